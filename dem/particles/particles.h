/* Particles between steps: adding them, their energy, loads and motion, and what acts on all of them. */
#pragma once
#include "../base/definition.h"
#include "../energy/ledger.h"
#include "free_flight.h"

/* Makes the present step the origin of particle i: the state of its parabola becomes the stored one. */
static inline void dem__set_origin(dem_world *w, ptrdiff_t i) {
    dem__rigid *r = dem__rigid_of(w, i);
    if (r) {
        w->engine->bodies.calls->set_origin(w, r);
        return;
    }
    const double tau = dem__now(w, i);
    dem_particle *p = &w->particle[i];
    p->x = dem__at(w, i, tau), p->v = dem__velocity_at(w, i, tau), p->spin = dem__spin_at(w, i, tau);
    w->particle[i].origin = w->step;
}

/* Puts a stored position back into the periodic box. Where gravity has a component along the box, the particle gains
   potential energy, which is booked. */
DEM_INLINE void dem__wrap(dem_world *w, ptrdiff_t i) {
    dem_particle *p = &w->particle[i];
    const dem_vec x = dem__in_box(w, p->x);
    if (w->engine->ledger.on && !dem__is_fixed(w, i))
        dem__book_wrap(w, -p->mass * dem__dot(dem__free_fall(w), dem__sub(x, p->x)));
    p->x = x;
}

/* Returns the number of rigid bodies present: the array keeps those that are gone until lists are built anew. */
static inline ptrdiff_t dem__bodies_present(const dem_world *w) {
    const dem__bodies *bodies = &w->engine->bodies;
    ptrdiff_t present = 0;
    for (ptrdiff_t k = 0; k < bodies->rigid_count; k++) present += w->alive[bodies->rigid[k].first] != DEM_GONE;
    return present;
}

DEM_INLINE double dem__inertia(const dem_world *w, ptrdiff_t i) {
    return 0.4 * w->particle[i].mass * w->particle[i].radius * w->particle[i].radius;
}

/* Returns the kinetic energy of particle i [J]. The energies of a rigid body are those of its first particle, so that
   sums over particles count it once. A fixed particle, like a wall, has none. */
DEM_INLINE double dem__kinetic(const dem_world *w, ptrdiff_t i) {
    const dem__rigid *r = dem__rigid_of(w, i);
    if (dem__is_fixed(w, i)) return 0.0;
    if (r) {
        const dem_vec u = dem__plus(r->v, dem__now(w, i), r->a);
        return r->first == i ? 0.5 * r->mass * dem__dot(u, u) : 0.0;
    }
    dem_vec v = dem__velocity_at(w, i, dem__now(w, i));
    return 0.5 * w->particle[i].mass * dem__dot(v, v);
}
DEM_INLINE double dem__rotational(const dem_world *w, ptrdiff_t i) {
    const dem__rigid *r = dem__rigid_of(w, i);
    if (dem__is_fixed(w, i)) return 0.0;
    if (r) {
        const dem__posture p = dem__posture_at(w, r, dem__now(w, i));
        return r->first == i ? 0.5 * dem__dot(p.spin, p.momentum) : 0.0;
    }
    const dem_vec s = dem__spin_at(w, i, dem__now(w, i));
    return 0.5 * dem__inertia(w, i) * dem__dot(s, s);
}
DEM_INLINE double dem__motion_energy(const dem_world *w, ptrdiff_t i) {
    return dem__kinetic(w, i) + dem__rotational(w, i);
}
DEM_INLINE double dem__potential(const dem_world *w, ptrdiff_t i) {
    const dem__rigid *r = dem__rigid_of(w, i);
    if (dem__is_fixed(w, i)) return 0.0;
    if (r) {
        const double tau = dem__now(w, i);
        const dem_vec x = dem__plus(r->x, tau, dem__plus(r->v, 0.5 * tau, r->a));
        return r->first == i ? -r->mass * dem__dot(dem__free_fall(w), x) : 0.0;
    }
    return -w->particle[i].mass * dem__dot(dem__free_fall(w), dem__at(w, i, dem__now(w, i)));
}

/* Makes the present step the origin where a caller changes particle i between runs. In a force field it takes the most
   accurate velocity that is known. */
static inline void dem__restart(dem_world *w, ptrdiff_t i) {
    const dem_vec error = dem__velocity_error(w, i, dem__now(w, i));
    dem__rigid *r = dem__rigid_of(w, i);
    dem__set_origin(w, i);
    if (!w->engine->field.on) return;
    dem__book_field_work(w, -dem__motion_energy(w, i));
    if (r) {
        r->v = dem__add(r->v, error);
        w->engine->bodies.calls->place(w, r);
    } else w->particle[i].v = dem__add(w->particle[i].v, error);
    dem__book_field_work(w, dem__motion_energy(w, i));
}

DEM_INLINE double dem__nearest(double d, double length) {
    return fabs(d) < 0.499999 * length ? d : d - length * floor(d / length + 0.5);
}

DEM_INLINE dem_vec dem__nearest_image(const dem_world *w, dem_vec d) {
    if (w->engine->run.has_periodic) {
        if (w->def.periodic[0]) d.x = dem__nearest(d.x, w->def.high.x - w->def.low.x);
        if (w->def.periodic[1]) d.y = dem__nearest(d.y, w->def.high.y - w->def.low.y);
        if (w->def.periodic[2]) d.z = dem__nearest(d.z, w->def.high.z - w->def.low.z);
    }
    return d;
}

/* Returns the number of steps between two evaluations of the links, also for a loaded world without their law. */
DEM_INLINE int dem__steps_of_links(const dem_world *w) {
    const double n = floor(w->engine->links.interval / w->engine->run.dt);
    return n < 1.0 ? 1 : n > 1000.0 ? 1000 : (int)n;
}

/* Returns the time since links were evaluated [s]. */
DEM_INLINE double dem__since_evaluated(const dem_world *w) {
    return w->engine->run.dt * (double)(w->step - w->engine->links.evaluated_step);
}

/* Returns the work of the link forces on particle i, which is at x and has a spin, since they were evaluated [J]. */
DEM_INLINE double dem__link_work_until(const dem_world *w, ptrdiff_t i, dem_vec x, dem_vec spin) {
    const dem__bodies *bodies = &w->engine->bodies;
    const dem__links *links = &w->engine->links;
    const double turned = 0.5 * dem__since_evaluated(w);
    const dem_vec way = dem__nearest_image(w, dem__sub(x, dem__first(links->evaluated_at[i])));
    const dem_vec force = dem__sub(dem__first(bodies->load[i]), dem__first(bodies->external[i]));
    const dem_vec torque = dem__sub(dem__second(bodies->load[i]), dem__second(bodies->external[i]));
    return dem__dot(force, way) + turned * dem__dot(torque, dem__add(spin, dem__second(links->evaluated_at[i])));
}
static inline double dem__link_work(const dem_world *w, ptrdiff_t i) {
    const double tau = dem__now(w, i);
    if (!w->engine->links.is_loaded[i] || dem__is_fixed(w, i)) return 0.0;
    return dem__link_work_until(w, i, dem__at(w, i, tau), dem__spin_at(w, i, tau));
}

/* Stop and resume counting the work of links on some particles, while a caller changes how they move. The spin from
   which counting resumes is the one that a particle would have had at the last evaluation. */
static inline void dem__stop_link_work(dem_world *w, dem__pieces of) {
    for (ptrdiff_t k = of.first; k < of.end && w->engine->ledger.on; k++) dem__book_link_work(w, dem__link_work(w, k));
}
static inline void dem__resume_link_work(dem_world *w, dem__pieces of) {
    for (ptrdiff_t k = of.first; k < of.end && w->engine->ledger.on; k++) {
        double *from = w->engine->links.evaluated_at[k];
        const double tau = dem__now(w, k);
        if (!w->engine->links.is_loaded[k]) continue;
        const dem_vec x = dem__at(w, k, tau),
                      spin = dem__plus(dem__spin_at(w, k, tau), -dem__since_evaluated(w), w->spin_rate[k]);
        for (int a = 0; a < 3; a++) from[a] = dem_axis(x, a), from[3 + a] = dem_axis(spin, a);
        dem__book_link_work(w, -dem__link_work(w, k));
    }
}
static inline dem__pieces dem__all_particles(const dem_world *w) {
    dem__pieces all;
    all.first = 0, all.end = w->count;
    return all;
}

/* Sets what turns forces on particle i into accelerations. */
static inline void dem__set_inverse_mass(dem_world *w, ptrdiff_t i) {
    dem__sum *sum = &w->engine->bodies.sum[i];
    sum->per_mass = dem__per_mass(w, i);
    sum->per_inertia = 2.5 * sum->per_mass / (w->particle[i].radius * w->particle[i].radius);
}

/* Sets the share of its mass that a particle has in each of its contacts. */
DEM_INLINE void dem__set_mass_share(dem_world *w, ptrdiff_t i) {
    w->engine->bodies.mass_share[i] = w->touching[i] > 1 && !dem__is_fixed(w, i) ? 1.0 / (double)w->touching[i] : 1.0;
}

/* Sets the acceleration of particle i without contacts. */
static inline void dem__free_acceleration(dem_world *w, ptrdiff_t i) {
    dem__bodies *bodies = &w->engine->bodies;
    dem__rigid *r = dem__rigid_of(w, i);
    if (r) {
        bodies->calls->fall(w, r);
        return;
    }
    if (dem__is_fixed(w, i)) {
        w->particle[i].a = w->spin_rate[i] = dem_vec3(0.0, 0.0, 0.0);
        return;
    }
    const dem__sum *sum = &bodies->sum[i];
    w->particle[i].a = dem__plus(dem__free_fall(w), sum->per_mass, dem__first(bodies->load[i]));
    w->spin_rate[i] = dem__scale(sum->per_inertia, dem__second(bodies->load[i]));
}

DEM_INLINE double dem__sphere_mass(const dem_world *w, int material, double radius) {
    const double d = 2.0 * radius;
    return RIDDLE_PI / 6.0 * d * d * d * w->def.material[material].density;
}

/* Returns whether a diameter gives a mass and an inertia that are numbers. */
static inline int dem__is_size(const dem_world *w, int material, double d) {
    return dem__positive(d) && dem__positive(dem__sphere_mass(w, material, 0.5 * d) * d * d);
}

/* Makes room for n more particles. Returns 0 when out of memory. */
static inline int dem__reserve_particles(dem_world *w, ptrdiff_t n) {
    dem__array list[DEM__ARRAYS_MAX];
    dem__bodies *bodies = &w->engine->bodies;
    return w->count + n + 1 <= bodies->capacity ||
           dem__grow_group(w, list, dem__particle_arrays(w, list), &bodies->block, &bodies->bytes, &bodies->capacity,
                           w->count + n + 1);
}

/* Adds a particle at rest, for which there is room. Returns its number. */
static inline ptrdiff_t dem__put_particle(dem_world *w, dem_vec x, double radius, double mass, int material,
                                          int group) {
    const ptrdiff_t i = w->count++;
    dem__bodies *bodies = &w->engine->bodies;
    dem_particle *p = &w->particle[i];
    p->x = dem__in_box(w, x);
    p->v = dem_vec3(0.0, 0.0, 0.0);
    p->spin = dem_vec3(0.0, 0.0, 0.0);
    for (int a = 0; a < 6; a++) bodies->load[i][a] = bodies->external[i][a] = 0.0;
    p->radius = radius;
    p->mass = mass;
    if (bodies->has_fixed) memset(&bodies->fixed[i], 0, sizeof *bodies->fixed);
    dem__set_inverse_mass(w, i);
    w->particle[i].origin = w->step;
    w->id[i] = bodies->next_id++;
    bodies->number[i] = (int32_t)(i - bodies->dropped);
    w->material[i] = material;
    w->group[i] = group;
    w->alive[i] = 1;
    w->touching[i] = bodies->activity[i] = 0;
    w->engine->walls.first_contact[i] = w->engine->links.first_link[i] = -1;
    w->engine->links.is_loaded[i] = 0;
    memset(&bodies->bound[i], 0, sizeof bodies->bound[i]);
    bodies->impact[i] = dem_vec3(0.0, 0.0, 0.0);
    if (bodies->rigid) bodies->rigid_of[i] = 0;
    if (w->engine->convex.shapes > 0)
        w->engine->convex.shape_of[i] = 0; /* a polyhedron that has gone may have had this entry */
    if (w->engine->field.on)
        w->engine->field.until[i] = DEM__NO_FLIGHT, w->engine->field.force[i] = dem_vec3(0.0, 0.0, 0.0);
    return i;
}

DEM_API dem_status dem_add_spheres(dem_world *world, ptrdiff_t n, const double *centres, const double *diameters,
                                   int material, int group) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (!w || !w->def.allocator.fn || n < 0 || (n > 0 && (!centres || !diameters)) || material < 0 ||
        material >= w->def.materials)
        return DEM_BAD_ARGUMENT;
    if (n > INT32_MAX / 4 - w->count) return DEM_TOO_MANY;
    for (ptrdiff_t k = 0; k < n; k++) {
        const dem_vec at = dem_vec3(centres[3 * k], centres[3 * k + 1], centres[3 * k + 2]);
        if (!dem__is_size(w, material, diameters[k]) || !dem__finite_vec(at) || !dem__is_place(dem__in_box(w, at)))
            return DEM_BAD_ARGUMENT;
    }
    if (!dem__reserve_particles(w, n)) return DEM_OUT_OF_MEMORY;
    for (ptrdiff_t k = 0; k < n; k++) {
        const dem_vec x = dem_vec3(centres[3 * k], centres[3 * k + 1], centres[3 * k + 2]);
        const ptrdiff_t i = dem__put_particle(w, x, 0.5 * diameters[k],
                                              dem__sphere_mass(w, material, 0.5 * diameters[k]), material, group);
        dem__free_acceleration(w, i);
        dem__book_added(w, dem__potential(w, i));
    }
    if (n > 0) w->engine->run.needs_forces = w->engine->run.needs_lists = 1;
    return DEM_OK;
}

/* Sets the number of steps between two evaluations of the links, and the step of the last one as it would have been
   with it. */
static inline void dem__set_link_steps(dem_world *w) {
    dem__links *links = &w->engine->links;
    if (!links->on) return;
    if (links->law) links->every = dem__steps_of_links(w);
    links->evaluated_step = w->step - w->step % dem__steps_of_links(w);
}

DEM_API dem_status dem_set_time_step(dem_world *world, double dt) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (!w || !w->def.allocator.fn || !dem__is_time_step(dt)) return DEM_BAD_ARGUMENT;
    dem__stop_link_work(w, dem__all_particles(w));
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i]) dem__restart(w, i);
    }
    w->engine->run.start_time = w->time;
    w->engine->run.start_step = w->step;
    w->def.dt = w->engine->run.dt = dt;
    dem__set_link_steps(w);
    dem__resume_link_work(w, dem__all_particles(w));
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    return DEM_OK;
}

DEM_API dem_status dem_set_gravity(dem_world *world, dem_vec gravity) {
    dem_world *w = world;
    if (dem__is_running(w)) return DEM_BUSY;
    if (!w || !w->def.allocator.fn || !dem__moderate_vec(gravity)) return DEM_BAD_ARGUMENT;
    const dem_vec change = dem__sub(gravity, w->def.gravity);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i] || dem__is_fixed(w, i)) continue;
        dem__rigid *r = dem__rigid_of(w, i);
        dem__restart(w, i);
        w->particle[i].a = dem__add(w->particle[i].a, change);
        if (r && r->first == i) r->a = dem__add(r->a, change);
    }
    if (w->engine->ledger.on) {
        for (ptrdiff_t i = 0; i < w->count; i++) {
            const dem__rigid *r = dem__rigid_of(w, i);
            const dem_vec x = r ? r->x : w->particle[i].x;
            const double raised = w->alive[i] && (!r || r->first == i) && !dem__is_fixed(w, i)
                                      ? -w->particle[i].mass * dem__dot(change, x)
                                      : 0.0;
            dem__book_gravity(w, raised);
        }
    }
    w->def.gravity = gravity;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i] && !w->touching[i]) dem__free_acceleration(w, i);
    }
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    return DEM_OK;
}

DEM_API dem_status dem_set_pair(dem_world *world, int a, int b, const dem_pair_def *pair) {
    dem_world *w = world;
    if (dem__is_running(w)) return DEM_BUSY;
    if (!w || !w->def.allocator.fn || !pair || a < 0 || b < 0 || a >= w->def.materials || b >= w->def.materials ||
        dem__bad_pair(pair))
        return DEM_BAD_ARGUMENT;
    dem_pair_def *own = dem_pair(&w->def, a, b);
    *own = *pair, own->given = 1;
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    return DEM_OK;
}

DEM_INLINE int dem__has_load(const dem_world *w, ptrdiff_t i) {
    const double *e = w->engine->bodies.external[i];
    return e[0] != 0.0 || e[1] != 0.0 || e[2] != 0.0 || e[3] != 0.0 || e[4] != 0.0 || e[5] != 0.0;
}

/* Returns whether particle i, or any particle of its rigid body, has a load or is fixed. */
DEM_INLINE int dem__is_loaded(const dem_world *w, ptrdiff_t i) {
    const dem__pieces own = dem__pieces_of(w, i);
    int loaded = dem__is_fixed(w, i); /* does not fall */
    for (ptrdiff_t k = own.first; k < own.end; k++) loaded |= dem__has_load(w, k);
    return loaded;
}

/* Makes particle i take steps from now on. */
DEM_INLINE void dem__wake_one(dem_world *w, ptrdiff_t i) {
    dem__bodies *bodies = &w->engine->bodies;
    if (bodies->activity[i]) return;
    bodies->activity[i] = 1;
    bodies->active[bodies->active_count++] = (int32_t)i;
}
/* Makes particle i, or all particles of its rigid body, take steps from now on. */
DEM_INLINE void dem__wake(dem_world *w, ptrdiff_t i) {
    const dem__pieces own = dem__pieces_of(w, i);
    for (ptrdiff_t k = own.first; k < own.end; k++) dem__wake_one(w, k);
}

static inline int dem__is_present(const dem_world *w, ptrdiff_t i) {
    return w && i >= 0 && i < w->count && w->alive[i];
}

DEM_API dem_status dem_set_motion(dem_world *world, ptrdiff_t i, dem_vec velocity, dem_vec spin) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (!dem__is_present(w, i) || !dem__moderate_vec(velocity) || !dem__moderate_vec(spin)) return DEM_BAD_ARGUMENT;
    dem__rigid *r = dem__rigid_of(w, i);
    if (r) i = r->first;
    if (r && dem__is_fixed(w, i) && dem__dot(spin, spin) > 0.0) return DEM_BAD_ARGUMENT;
    dem__stop_link_work(w, dem__pieces_of(w, i));
    dem__restart(w, i);
    dem__book_motion(w, -dem__motion_energy(w, i));
    w->particle[i].v = dem__flushed_vec(velocity);
    w->particle[i].spin = dem__flushed_vec(spin);
    if (r) w->engine->bodies.calls->set_motion(w, r, dem__flushed_vec(velocity), dem__flushed_vec(spin));
    dem__book_motion(w, dem__motion_energy(w, i));
    dem__resume_link_work(w, dem__pieces_of(w, i));
    w->engine->run.needs_lists = 1;
    return DEM_OK;
}

DEM_API dem_status dem_set_load(dem_world *world, ptrdiff_t i, dem_vec force, dem_vec torque) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (!dem__is_present(w, i) || !dem__moderate_vec(dem__scale(1.0 / w->particle[i].mass, force)) ||
        !dem__moderate_vec(dem__scale(1.0 / dem__inertia(w, i), torque)))
        return DEM_BAD_ARGUMENT;
    dem__stop_link_work(w, dem__pieces_of(w, i));
    dem__restart(w, i);
    double *load = w->engine->bodies.load[i], *external = w->engine->bodies.external[i];
    dem_vec *const rate[] = {&w->particle[i].a, &w->spin_rate[i]};
    const double wanted[] = {force.x, force.y, force.z, torque.x, torque.y, torque.z};
    dem__rigid *r = dem__rigid_of(w, i);
    if (r && !dem__is_fixed(w, i)) {
        const dem_vec more = dem__sub(force, dem__first(external));
        r->a = dem__plus(r->a, 1.0 / r->mass, more);
        r->torque = dem__add(dem__add(r->torque, dem__sub(torque, dem__second(external))),
                             dem__cross(w->engine->bodies.arm[i], more));
    }
    const int fixed = dem__is_fixed(w, i);
    for (int a = 0; a < 6; a++) {
        const double change = wanted[a] - external[a];
        if (!fixed) *dem_axis_of(rate[a / 3], a % 3) += change / (a < 3 ? w->particle[i].mass : dem__inertia(w, i));
        load[a] = !w->engine->links.is_loaded[i] ? wanted[a] : load[a] + change;
        external[a] = wanted[a];
    }
    if (r) w->engine->bodies.calls->place(w, r);
    if (!w->touching[i]) dem__free_acceleration(w, i);
    dem__resume_link_work(w, dem__pieces_of(w, i));
    dem__wake(w, i); /* a loaded particle is not in free flight */
    w->engine->bodies.loads_on = w->engine->run.needs_lists = 1;
    return DEM_OK;
}
