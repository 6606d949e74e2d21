/* Getters: present states, energy, contacts and links, apertures of a screen. They read a const world. */
#pragma once
#include "../contacts/block.h"

DEM_API dem_vec dem_position(const dem_world *world, ptrdiff_t i) {
    if (!world || i < 0 || i >= world->count) return dem_vec3((double)NAN, (double)NAN, (double)NAN);
    return dem__in_box(world, dem__at(world, i, dem__now(world, i)));
}

DEM_API dem_vec dem_velocity(const dem_world *world, ptrdiff_t i) {
    if (!world || i < 0 || i >= world->count) return dem_vec3((double)NAN, (double)NAN, (double)NAN);
    return dem__true_velocity_at(world, i, dem__now(world, i));
}

DEM_API dem_vec dem_spin(const dem_world *world, ptrdiff_t i) {
    if (!world || i < 0 || i >= world->count) return dem_vec3((double)NAN, (double)NAN, (double)NAN);
    return dem__spin_at(world, i, dem__now(world, i));
}

DEM_API double dem_radius(const dem_world *world, ptrdiff_t i) {
    return world && i >= 0 && i < world->count ? world->particle[i].radius : (double)NAN;
}
DEM_API double dem_mass(const dem_world *world, ptrdiff_t i) {
    return world && i >= 0 && i < world->count ? world->particle[i].mass : (double)NAN;
}

DEM_API dem_vec dem_momentum(const dem_world *world) {
    dem_vec sum = dem_vec3(0.0, 0.0, 0.0);
    for (ptrdiff_t i = 0; world && i < world->count; i++) {
        if (!world->alive[i] || !dem__leads(world, i)) continue;
        sum = dem__add(sum, dem__scale(world->particle[i].mass, dem__true_drift_at(world, i, dem__now(world, i))));
    }
    return sum;
}

DEM_API ptrdiff_t dem_contact_count(const dem_world *world) {
    return world && world->engine ? world->engine->contacts.count : 0;
}

/* Sets normal and point of a polyhedron's contact to those that the kernel uses. */
static inline void dem__get_place(const dem_world *w, ptrdiff_t slot, dem_contact_info *info) {
    const double gap = w->engine->contacts.touch[DEM__PLACE_GAP][slot], radius = dem__touching_radius(w, info->i);
    const double part = info->j >= 0 ? radius / (radius + dem__touching_radius(w, info->j)) : 1.0;
    info->normal = dem__place_normal(w, slot);
    const dem_vec arm = dem__plus(dem__place_arm(w, slot), -(radius + part * gap), info->normal);
    double *const *torque = w->engine->contacts.wrench + 3;
    info->point = dem__add(dem_position(w, info->i), arm);
    info->couple = dem__sub(dem_vec3(torque[0][slot], torque[1][slot], torque[2][slot]), dem__cross(arm, info->force));
}

/* Finds normal and point of the contact in a slot, or of a link (slot -1), from the present positions; polyhedra keep
   theirs. */
static inline void dem__find_point(const dem_world *w, ptrdiff_t slot, dem_contact_info *info) {
    const dem_vec x = dem_position(w, info->i);
    const double radius = w->particle[info->i].radius;
    if (slot >= 0 && dem__has_polyhedron(w, info->i, info->j)) {
        dem__get_place(w, slot, info);
        return;
    }
    if (info->j < 0) {
        dem__touch touch;
        dem__touch_place(w, slot, &w->wall[-1 - info->j], x, radius, info->element, &touch);
        info->normal = touch.normal;
        info->point = dem__plus(x, -(radius + touch.gap), touch.normal);
        return;
    }
    const dem_vec d = dem__nearest_image(w, dem__sub(x, dem_position(w, info->j)));
    info->point = dem__plus(x, -radius / (radius + w->particle[info->j].radius), d);
    dem__unit(d, &info->normal);
}

DEM_API dem_contact_info dem_get_contact(const dem_world *world, ptrdiff_t k) {
    dem_contact_info info;
    memset(&info, 0, sizeof info);
    info.gap = (double)NAN;
    if (!world || !world->engine || k < 0 || k >= world->engine->contacts.count) return info;
    k = dem__slot_of(world, k);
    info.i = world->engine->contacts.i[k];
    info.j = world->engine->contacts.j[k];
    info.gap = world->engine->contacts.gap[k];
    info.force = dem_vec3(world->engine->contacts.wrench[0][k], world->engine->contacts.wrench[1][k],
                          world->engine->contacts.wrench[2][k]);
    info.element = world->engine->contacts.element[k];
    for (int a = 0; a < world->engine->contacts.states; a++) info.state[a] = world->engine->contacts.state[a][k];
    dem__find_point(world, k, &info);
    return info;
}

DEM_API void dem_set_contact_state(dem_world *world, ptrdiff_t k, const double *state) {
    if (!world || !world->engine || !state || k < 0 || k >= world->engine->contacts.count) return;
    for (int a = 0; a < world->engine->contacts.states; a++)
        world->engine->contacts.state[a][dem__slot_of(world, k)] = state[a];
    if (!dem__is_running(world))
        world->engine->run.needs_forces = 1; /* the next run computes them, and books what the states store */
}

DEM_API dem_apertures dem_count_apertures(const dem_world *world, int wall) {
    dem_apertures count = {0, 0, 0};
    if (!world || wall < 0 || wall >= world->walls || world->wall[wall].kind != DEM_SCREEN) return count;
    const dem_wall *s = &world->wall[wall];
    const double pitch = s->aperture + s->wire, half = 0.5 * pitch;
    const int nx = (int)(s->half_x / pitch) + 1, ny = (int)(s->half_y / pitch) + 1;
    for (int a = -nx; a <= nx; a++) {
        for (int b = -ny; b <= ny; b++) {
            double x = fabs(a * pitch) + half, y = fabs(b * pitch) + half;
            count.total += s->circular ? x * x + y * y <= s->half_x * s->half_x : x <= s->half_x && y <= s->half_y;
        }
    }
    count.free = count.total;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        if (!world->alive[i] || world->touching[i] < 2 || dem__shape_of(world, i)) continue;
        const dem_vec d = dem__sub(dem__at(world, i, dem__now(world, i)), s->position);
        if (!(fabs(dem__dot(d, s->axis[2])) < world->particle[i].radius)) continue;
        dem_vec normal[DEM__TOUCHES];
        int n = 0, holding = 0;
        for (int32_t c = world->engine->walls.first_contact[i]; c >= 0 && n < DEM__TOUCHES;
             c = world->engine->contacts.wall_next[c]) {
            dem__touch touch;
            if (world->engine->contacts.j[c] != -1 - wall || !(world->engine->contacts.gap[c] < 0.0)) continue;
            dem__touch_element(s, dem__add(d, s->position), world->particle[i].radius,
                               world->engine->contacts.element[c], &touch);
            normal[n++] = touch.normal;
        }
        if (n < 2) continue;
        const int m = s->material < world->material[i] ? s->material : world->material[i];
        const double mu = world->def.pair[m][s->material + world->material[i] - m].friction;
        const dem_vec up = s->axis[2];
        for (int a = 0; a < n;
             a++) { /* a particle is wedged if the line between two contacts lies within both friction cones */
            for (int b = a + 1; b < n; b++) {
                const double za = dem__dot(normal[a], up), zb = dem__dot(normal[b], up);
                const dem_vec flat_a = dem__sub(normal[a], dem__scale(za, up)),
                              flat_b = dem__sub(normal[b], dem__scale(zb, up));
                if (dem__dot(flat_a, flat_b) < -0.5 && fabs(za) <= mu * dem__length(flat_a) &&
                    fabs(zb) <= mu * dem__length(flat_b))
                    holding = 1;
            }
        }
        count.occupied++;
        count.free -= holding;
    }
    return count;
}
