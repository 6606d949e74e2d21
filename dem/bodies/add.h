/* Rigid bodies as a feature of a world, and how to add one. */
#pragma once
#include "save.h"

static inline int dem__list_arrays_of_bodies(dem_world *w, dem__array *list) {
    dem__bodies *bodies = &w->engine->bodies;
    const dem__array arrays[] = {{&bodies->rigid_of, sizeof *bodies->rigid_of},
                                 {&bodies->offset, sizeof *bodies->offset},
                                 {&bodies->arm, sizeof *bodies->arm}};
    memcpy(list, arrays, sizeof arrays);
    return (int)(sizeof arrays / sizeof *arrays);
}

static inline void dem__release_bodies(dem_world *w) {
    dem__bodies *bodies = &w->engine->bodies;
    dem__release(&w->def.allocator, bodies->rigid, (size_t)bodies->rigid_capacity * sizeof *bodies->rigid);
}

static inline void dem__add_unattached(dem_world *w, ptrdiff_t i) { w->engine->bodies.rigid_of[i] = 0; }

/* Renumbers rigid bodies and their first particles after dropped particles have been removed. Bodies are in the order
   of their particles. */
static inline void dem__renumber_bodies(dem_world *w, const int32_t *number) {
    dem__bodies *bodies = &w->engine->bodies;
    ptrdiff_t n = 0;
    (void)number;
    for (ptrdiff_t i = 0; i < w->count && bodies->rigid; i++) {
        if (bodies->rigid_of[i] == 0) continue;
        dem__rigid *r = &bodies->rigid[n++];
        *r = bodies->rigid[bodies->rigid_of[i] - 1];
        r->first = (int32_t)i;
        for (ptrdiff_t end = i + r->pieces; i < end; i++) bodies->rigid_of[i] = (int32_t)n;
        i--;
    }
    if (bodies->rigid) bodies->rigid_count = n;
}

static inline dem__feature dem__feature_bodies(void) {
    dem__feature f = dem__new_feature(DEM__BODIES_FEATURE);
    f.turns = 1;
    f.list_arrays = dem__list_arrays_of_bodies;
    f.release = dem__release_bodies;
    f.add_particle = dem__add_unattached;
    f.renumber = dem__renumber_bodies;
    f.keep_up = dem__keep_rotations;
    f.kick = dem__kick_active_bodies;
    f.kicked = dem__place_loaded_bodies;
    f.corrected = dem__shift_corrected;
    f.particle_fields = dem__particle_fields_of_bodies;
    f.save = dem__save_bodies;
    f.is_used = dem__has_bodies;
    f.load = dem__load_bodies;
    f.hash = dem__hash_rigids;
    return f;
}

/* Definition of a rigid body: see bodies/rigid.h. */
typedef struct dem__body_def {
    dem_vec x;             /* centre of mass [m] */
    double mass;           /* [kg] */
    dem_vec moments;       /* about the principal axes [kg m2] */
    dem_quaternion frame;  /* from the principal axes to the frame in which the shape is given */
    dem_quaternion turn;   /* from that frame to the lab's axes */
    ptrdiff_t pieces;      /* of each particle, from the centre of mass along the principal axes [m] */
    const dem_vec *offset; /* of each from the centre of mass, along the principal axes [m] */
    const double *radius;  /* [m] */
    int material, group;
} dem__body_def;

/* Makes room for n more bodies with `pieces` particles in all. Returns 0 when out of memory. */
static inline int dem__reserve_bodies(dem_world *w, ptrdiff_t n, ptrdiff_t pieces) {
    return dem__take_feature(w, dem__feature_bodies()) == DEM_OK && /* comes first: it frees the bodies */
           dem__grow_bodies(w, n) && dem__reserve_particles(w, pieces);
}

/* Adds a body at rest, for which dem__reserve_bodies has made room. Returns the number of its first particle. */
static inline ptrdiff_t dem__add_body(dem_world *w, const dem__body_def *def) {
    dem__bodies *bodies = &w->engine->bodies;
    dem__rigid *r = &bodies->rigid[bodies->rigid_count++];
    int order[3];
    memset(r, 0, sizeof *r);
    r->first = (int32_t)w->count, r->pieces = (int32_t)def->pieces;
    r->x = dem__in_box(w, def->x), r->mass = def->mass, r->moments = def->moments, r->frame = def->frame;
    dem__order_moments(&r->moments, &r->frame, order);
    r->turn = dem__kept_unit(dem__turns(def->turn, r->frame));
    for (ptrdiff_t k = 0; k < def->pieces; k++) {
        const ptrdiff_t i = dem__put_particle(w, r->x, def->radius[k], def->mass, def->material, def->group);
        const dem_vec from = def->offset[k];
        bodies->rigid_of[i] = (int32_t)bodies->rigid_count;
        bodies->offset[i] = dem_vec3(dem_axis(from, order[0]), dem_axis(from, order[1]), dem_axis(from, order[2]));
    }
    dem__set_rate(w, r);
    dem__free_body(w, r);
    dem__book_added(w, dem__potential(w, r->first));
    w->engine->run.needs_forces = w->engine->run.needs_lists = 1;
    return r->first;
}
