/* Fixed particles: obstacles at rest or in prescribed motion, and the forces on them. Every part that turns forces into
   motion calls dem__is_fixed(). */
#pragma once
#include "../records/groups.h"
#include "state.h"

static inline int dem__list_arrays_of_fixed(dem_world *w, dem__array *list) {
    list->address = &w->engine->bodies.fixed, list->size = sizeof *w->engine->bodies.fixed;
    return 1;
}

static inline void dem__add_unfixed(dem_world *w, ptrdiff_t i) {
    memset(&w->engine->bodies.fixed[i], 0, sizeof *w->engine->bodies.fixed);
}

static inline void dem__world_fields_of_fixed(dem_world *w, dem__group *g) {
    const dem__saved_field fields[] = {DEM__INTEGER("has_fixed", w->engine->bodies.has_fixed, 0)};
    dem__add_optional(g, fields, sizeof fields);
}

static inline void dem__particle_fields_of_fixed(dem_world *w, dem__group *g) {
    dem__fixed *fixed = w->engine->bodies.fixed;
    const dem__saved_field fields[] = {DEM__INTEGER("particle.fixed", fixed->on, sizeof *fixed),
                                       DEM__DOUBLES("particle.fixed_load", fixed->load, sizeof *fixed),
                                       DEM__DOUBLES("particle.fixed_impulse", fixed->impulse, sizeof *fixed)};
    dem__add_optional(g, fields, sizeof fields);
}

static inline int dem__has_fixed(const dem__file *file, const dem_world *w) {
    (void)file;
    return dem__is_flag(w->engine->bodies.has_fixed) ? w->engine->bodies.has_fixed : -1;
}

static inline void dem__derive_fixed(dem_world *w) { w->engine->bodies.loads_on = 1; }

static inline void dem__hash_fixed(uint64_t *hash, const dem_world *w, ptrdiff_t i) {
    const dem__fixed *f = &w->engine->bodies.fixed[i];
    if (f->on) dem__hash_f64(hash, f->load, 6), dem__hash_vec(hash, f->impulse);
}

static inline dem__feature dem__feature_fixed(void) {
    dem__feature f = dem__new_feature(DEM__FIXED_FEATURE);
    f.sorts = 1;
    f.list_arrays = dem__list_arrays_of_fixed;
    f.add_particle = dem__add_unfixed;
    f.world_fields = dem__world_fields_of_fixed;
    f.particle_fields = dem__particle_fields_of_fixed;
    f.is_used = dem__has_fixed;
    f.loaded = dem__derive_fixed;
    f.hash_particle = dem__hash_fixed;
    return f;
}

DEM_API dem_status dem_fix(dem_world *world, ptrdiff_t i, int fixed) {
    dem_world *w = world;
    if (dem__is_running(w)) return DEM_BUSY;
    if (dem__lacks_particle(w, i)) return DEM_BAD_ARGUMENT;
    if (fixed != 0 && fixed != 1) return dem__refuse(w, "fixed: neither 0 nor 1");
    dem__rigid *r = dem__rigid_of(w, i);
    const dem__pieces own = dem__pieces_of(w, i);
    if (dem__is_fixed(w, i) == fixed) return DEM_OK;
    if (dem__take_feature(w, dem__feature_fixed()) != DEM_OK) return DEM_OUT_OF_MEMORY;
    w->engine->bodies.has_fixed = 1;
    i = own.first;
    dem__begin_change(w, own);
    dem__restart(w, i);
    dem__book_removed(w, dem__motion_energy(w, i) + dem__potential(w, i), dem__potential(w, i));
    if (r && fixed) r->v = r->momentum = dem_vec3(0.0, 0.0, 0.0);
    for (ptrdiff_t k = own.first; k < own.end; k++) {
        memset(&w->engine->bodies.fixed[k], 0, sizeof *w->engine->bodies.fixed);
        w->engine->bodies.fixed[k].on = fixed;
        dem__set_inverse_mass(w, k);
        dem__set_mass_share(w, k);
        if (fixed) w->particle[k].v = w->particle[k].spin = dem_vec3(0.0, 0.0, 0.0);
    }
    dem__free_acceleration(w, i);
    dem__book_added(w, dem__potential(w, i));
    dem__book_motion(w, dem__motion_energy(w, i));
    dem__end_change(w, own);
    dem__wake(w, i); /* it takes steps, like a particle with a load */
    w->engine->bodies.loads_on = w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    return DEM_OK;
}

DEM_API int dem_is_fixed(const dem_world *world, ptrdiff_t i) {
    return dem__is_present(world, i) && dem__is_fixed(world, i);
}

DEM_API dem_status dem_get_fixed_force(const dem_world *world, ptrdiff_t i, dem_vec *force, dem_vec *torque,
                                       dem_vec *impulse) {
    const dem_world *w = world;
    if (!force || !torque || !impulse) return DEM_BAD_ARGUMENT;
    *force = *torque = *impulse = dem_vec3((double)NAN, (double)NAN, (double)NAN);
    if (!dem_is_fixed(w, i)) return DEM_BAD_ARGUMENT;
    const dem__rigid *r = dem__rigid_of(w, i);
    const dem__pieces own = dem__pieces_of(w, i);
    *force = *torque = *impulse = dem_vec3(0.0, 0.0, 0.0);
    for (ptrdiff_t k = own.first; k < own.end; k++) {
        const dem__fixed *f = &w->engine->bodies.fixed[k];
        const dem_vec on = dem__first(f->load), turning = dem__second(f->load);
        *force = dem__add(*force, on), *impulse = dem__add(*impulse, f->impulse);
        *torque = dem__add(*torque, r ? dem__add(turning, dem__cross(w->engine->bodies.arm[k], on)) : turning);
    }
    return DEM_OK;
}

/* Records the force on particle i at the end of a step, without the caller's loads, if it is fixed. half: half of the
   step [s]. Returns whether it is fixed. */
DEM_INLINE int dem__note_fixed_force(dem_world *w, ptrdiff_t i, dem_vec force, dem_vec torque, double half) {
    if (!dem__is_fixed(w, i)) return 0;
    dem__fixed *f = &w->engine->bodies.fixed[i];
    const double *external = w->engine->bodies.external[i];
    force = dem__sub(force, dem__first(external)), torque = dem__sub(torque, dem__second(external));
    f->impulse = dem__plus(f->impulse, half, dem__add(dem__first(f->load), force));
    for (int a = 0; a < 3; a++) f->load[a] = dem_axis(force, a), f->load[3 + a] = dem_axis(torque, a);
    return 1;
}

/* Records the impulse of a partial step on particle i, and its work, if it is fixed. Returns whether it is fixed. */
DEM_INLINE int dem__strike_fixed(dem_world *w, ptrdiff_t i, dem_vec impulse, dem_vec turn) {
    if (!dem__is_fixed(w, i)) return 0;
    const dem_particle *p = &w->particle[i];
    w->engine->bodies.fixed[i].impulse = dem__add(w->engine->bodies.fixed[i].impulse, impulse);
    dem__book_work_of_fixed(w, -dem__dot(impulse, p->v) - dem__dot(turn, p->spin));
    return 1;
}

/* Books the work that particle i does by its motion in a step, by the trapezoidal rule, if it is fixed. Returns whether
   it is fixed. */
static inline int dem__work_as_fixed(dem_world *w, ptrdiff_t i) {
    if (!dem__is_fixed(w, i)) return 0;
    const dem__bodies *bodies = &w->engine->bodies;
    const double *now = bodies->sum[i].load, *before = bodies->fixed[i].load, half = 0.5 * w->engine->run.dt;
    for (int a = 0; a < 3; a++) {
        const double of_links = bodies->load[i][a] - bodies->external[i][a],
                     turning = bodies->load[i][3 + a] - bodies->external[i][3 + a];
        dem__book_work_of_fixed(w, -half * (before[a] + now[a] + of_links) * dem_axis(w->particle[i].v, a));
        dem__book_work_of_fixed(w, -half * (before[3 + a] + now[3 + a] + turning) * dem_axis(w->particle[i].spin, a));
    }
    return 1;
}
