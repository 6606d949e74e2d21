/* Adding particles. */
#pragma once
#include "../motion/state.h"

DEM_INLINE double dem__sphere_mass(const dem_world *w, int material, double radius) {
    const double d = 2.0 * radius;
    return RIDDLE_PI / 6.0 * d * d * d * w->def.material[material].density;
}

/* Returns whether a diameter gives a finite mass and inertia. */
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
    DEM__TELL(w, add_particle, (w, i));
    dem__set_inverse_mass(w, i);
    w->particle[i].origin = w->step;
    w->id[i] = bodies->next_id++;
    bodies->number[i] = (int32_t)(i - bodies->dropped);
    bodies->rank[i] = bodies->by_rank[i] = (int32_t)i; /* it gets the last rank */
    w->material[i] = material;
    w->group[i] = group;
    w->alive[i] = 1;
    w->touching[i] = bodies->activity[i] = 0;
    w->engine->walls.first_contact[i] = -1;
    memset(&bodies->bound[i], 0, sizeof bodies->bound[i]);
    bodies->impact[i] = dem_vec3(0.0, 0.0, 0.0);
    return i;
}

DEM_API dem_status dem_add_spheres(dem_world *world, ptrdiff_t n, const double *centres, const double *diameters,
                                   int material, int group) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (dem__lacks_material(w, material)) return DEM_BAD_ARGUMENT;
    if (n < 0) return dem__refuse(w, "n: below 0");
    if (n > 0 && !centres) return dem__refuse(w, "centres: NULL");
    if (n > 0 && !diameters) return dem__refuse(w, "diameters: NULL");
    if (n > INT32_MAX / 4 - w->count) return DEM_TOO_MANY;
    for (ptrdiff_t k = 0; k < n; k++) {
        const dem_vec at = dem_vec3(centres[3 * k], centres[3 * k + 1], centres[3 * k + 2]);
        if (!dem__is_size(w, material, diameters[k]))
            return dem__refuse(w, "diameters: one is not above 0, or its mass and inertia are not normal numbers");
        if (!dem__finite_vec(at) || !dem__is_place(dem__in_box(w, at)))
            return dem__refuse(w, "centres: a coordinate is not finite or above 1e150");
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
