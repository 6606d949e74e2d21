/* Rigid bodies in a saved world. */
#pragma once
#include "../records/groups.h"
#include "rate.h"
#include "rigid.h"

/* Lists the fields of rigid bodies present. bodies.rigid_of follows from `first` and `pieces`. */
static inline void dem__body_fields(dem__rigid *r, dem__group *g) {
    const size_t s = sizeof *r;
    const dem__saved_field fields[] = {
        DEM__INTEGER("body.first", r->first, s),   DEM__INTEGER("body.pieces", r->pieces, s),
        DEM__DOUBLES("body.x", r->x, s),           DEM__DOUBLES("body.v", r->v, s),
        DEM__DOUBLES("body.a", r->a, s),           DEM__DOUBLES("body.momentum", r->momentum, s),
        DEM__DOUBLES("body.torque", r->torque, s), DEM__DOUBLES("body.turn", r->turn, s),
        DEM__DOUBLES("body.frame", r->frame, s),   DEM__DOUBLES("body.moments", r->moments, s),
        DEM__DOUBLES("body.mass", r->mass, s),
    };
    dem__set_fields(g, fields, sizeof fields, 11);
}

static inline void dem__particle_fields_of_bodies(dem_world *w, dem__group *g) {
    dem__bodies *bodies = &w->engine->bodies;
    const dem__saved_field pieces[] = {
        DEM__DOUBLES("particle.offset", bodies->offset[0], sizeof *bodies->offset),
        DEM__DOUBLES("particle.arm", bodies->arm[0], sizeof *bodies->arm),
    };
    dem__add_optional(g, pieces, sizeof pieces);
}

static inline void dem__save_bodies(dem__stream *s, dem_world *w, dem__group *g) {
    const dem__bodies *bodies = &w->engine->bodies;
    const uint64_t present = (uint64_t)dem__bodies_present(w);
    if (present == 0) return;
    dem__body_fields(bodies->rigid, g);
    for (int q = 0; q < g->fields; q++) {
        dem__begin_record(s, &g->field[q], present);
        for (ptrdiff_t k = 0; k < bodies->rigid_count; k++) {
            if (w->alive[bodies->rigid[k].first]) dem__write_entry(s, w, &g->field[q], k, q == 0);
        }
    }
}

static inline int dem__has_bodies(const dem__file *file, const dem_world *w) {
    (void)w;
    return dem__entries_of(file, "body.first") > 0;
}

/* Reads rigid bodies, and assigns their particles to them. */
static inline dem_status dem__load_bodies(const dem__file *file, dem_world *w, dem__group *g) {
    const ptrdiff_t n = dem__entries_of(file, "body.first");
    dem__bodies *bodies = &w->engine->bodies;
    if (!dem__grow_bodies(w, n)) return DEM_OUT_OF_MEMORY;
    dem__body_fields(bodies->rigid, g);
    memset(bodies->rigid, 0, (size_t)n * sizeof *bodies->rigid);
    if (!dem__read_group(file, g, n)) return DEM_BAD_DATA;
    for (bodies->rigid_count = 0; bodies->rigid_count < n;) {
        dem__rigid *r = &bodies->rigid[bodies->rigid_count++];
        const dem_quaternion t = r->turn;
        if (r->first < 0 || r->pieces < 1 || r->first > w->count - r->pieces) return DEM_BAD_DATA;
        if (!dem__positive(r->moments.x) || !dem__positive(r->moments.y) || !dem__positive(r->moments.z) ||
            !dem__positive(r->mass))
            return DEM_BAD_DATA;
        if (!(fabs(t.w * t.w + t.x * t.x + t.y * t.y + t.z * t.z - 1.0) < 1e-6)) return DEM_BAD_DATA;
        for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++) {
            if (dem__is_fixed(w, i) != dem__is_fixed(w, r->first)) return DEM_BAD_DATA;
            if (bodies->rigid_of[i] != 0 || w->particle[i].origin != w->particle[r->first].origin ||
                w->particle[i].mass != r->mass)
                return DEM_BAD_DATA;
            bodies->rigid_of[i] = (int32_t)bodies->rigid_count;
        }
        dem__set_rate(w, r);
    }
    return DEM_OK;
}

static inline void dem__hash_rigid(uint64_t *hash, const dem_world *w, const dem__rigid *r) {
    dem__hash_i64(hash, w->engine->bodies.number[r->first]), dem__hash_i64(hash, r->pieces);
    dem__hash_vec(hash, r->x), dem__hash_vec(hash, r->v), dem__hash_vec(hash, r->a);
    dem__hash_vec(hash, r->momentum), dem__hash_vec(hash, r->torque);
    dem__hash_quaternion(hash, r->turn), dem__hash_quaternion(hash, r->frame);
    dem__hash_vec(hash, r->moments), dem__hash_f64(hash, &r->mass, 1);
    for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++)
        dem__hash_vec(hash, w->engine->bodies.offset[i]), dem__hash_vec(hash, w->engine->bodies.arm[i]);
}

static inline void dem__hash_rigids(uint64_t *hash, const dem_world *w) {
    const dem__bodies *bodies = &w->engine->bodies;
    const int64_t present = dem__bodies_present(w);
    if (present > 0) dem__hash_i64(hash, present);
    for (ptrdiff_t k = 0; k < bodies->rigid_count; k++) {
        if (w->alive[bodies->rigid[k].first]) dem__hash_rigid(hash, w, &bodies->rigid[k]);
    }
}
