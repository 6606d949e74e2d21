/* Saving: writes the groups of save/fields.h as records. Reads a const world and writes nothing of it, so that several
   threads may save one. */
#pragma once
#include "../particles/particles.h"
#include "../polyhedra/save.h"
#include "fields.h"

/* Writes entry `at` of a group's field. is_body: the field is an index of a particle, which becomes its number among
   those present. */
static inline void dem__write_entry(dem__stream *s, const dem_world *w, const dem__saved_field *f, ptrdiff_t at,
                                    int is_body) {
    if (!is_body) {
        dem__stream_entry(s, f, at);
        return;
    }
    int32_t body = *(const int32_t *)(const void *)((const unsigned char *)f->data + (size_t)at * f->stride);
    if (body >= 0) body = w->engine->bodies.number[body];
    dem__stream_number(s, &body, sizeof body);
}

/* Writes a group of n consecutive entries. The first `bodies` fields are indices of particles. */
static inline void dem__write_group(dem__stream *s, const dem_world *w, const dem__group *g, ptrdiff_t n, int bodies) {
    for (int q = 0; q < g->fields && n > 0; q++) {
        dem__begin_record(s, &g->field[q], (uint64_t)n);
        for (ptrdiff_t k = 0; k < n; k++) dem__write_entry(s, w, &g->field[q], k, q < bodies);
    }
}

static inline void dem__write_particles(dem__stream *s, dem_world *w, dem__group *g) {
    const ptrdiff_t present = w->count - w->engine->bodies.dropped;
    if (present == 0) return;
    dem__particle_fields(w, g);
    for (int q = 0; q < g->fields; q++) {
        dem__begin_record(s, &g->field[q], (uint64_t)present);
        for (ptrdiff_t i = 0; i < w->count; i++) {
            if (w->alive[i]) dem__stream_entry(s, &g->field[q], i);
        }
    }
}

static inline void dem__write_bodies(dem__stream *s, dem_world *w, dem__group *g) {
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

static inline void dem__write_contacts(dem__stream *s, dem_world *w, dem__group *g) {
    const dem__contacts *contacts = &w->engine->contacts;
    dem__saved_chunk chunk[DEM__CHUNKS];
    for (int q = 0; q < contacts->chunk_count; q++) {
        const int32_t from = contacts->chunk[q].first_particle;
        chunk[q].count = contacts->chunk[q].count, chunk[q].capacity = contacts->chunk[q].capacity;
        chunk[q].first_particle = from == 0         ? 0
                                  : from < w->count ? w->engine->bodies.number[from]
                                                    : (int32_t)(w->count - w->engine->bodies.dropped);
    }
    dem__chunk_fields(chunk, g);
    dem__write_group(s, w, g, contacts->chunk_count, 0);
    if (contacts->count == 0) return;
    dem__contact_fields(w, g);
    for (int q = 0; q < g->fields; q++) {
        dem__begin_record(s, &g->field[q], (uint64_t)contacts->count);
        DEM__EACH_CONTACT(w, c) { dem__write_entry(s, w, &g->field[q], c, q < 2); }
    }
}

static inline void dem__write_meshes(dem__stream *s, const dem_world *w, dem__group *g) {
    dem__group triangles;
    for (int k = 0; k < w->walls; k++) {
        const dem__tree *tree = w->wall[k].tree;
        if (!tree) continue;
        dem__mesh_fields(tree->vertex, tree->corner, k, g, &triangles);
        dem__write_group(s, w, g, tree->vertices, 0);
        dem__write_group(s, w, &triangles, tree->triangles, 0);
    }
}

static inline void dem__write_materials(dem__stream *s, dem_world *w, dem__group *g) {
    const int n = w->def.materials;
    dem_pair_def pair[DEM_MATERIALS_MAX * DEM_MATERIALS_MAX]; /* without gaps: DEM_MATERIALS_MAX may change */
    for (int k = 0; k < n * n; k++) pair[k] = w->def.pair[k / n][k % n];
    dem__material_fields(w->def.material, g), dem__write_group(s, w, g, n, 0);
    dem__pair_fields(pair, g), dem__write_group(s, w, g, n * n, 0);
}

/* Writes a world, or counts its bytes. */
static inline void dem__write_world(dem__stream *s, dem_world *w) {
    uint64_t magic = DEM__MAGIC, version = DEM__FORMAT;
    dem__group g;
    dem__stream_u64(s, &magic), dem__stream_u64(s, &version);
    dem__world_fields(w, &g), dem__write_group(s, w, &g, 1, 0);
    dem__write_materials(s, w, &g);
    dem__wall_fields(w->wall, &g), dem__write_group(s, w, &g, w->walls, 0);
    dem__write_meshes(s, w, &g);
    if (w->engine->convex.shapes > 0) {
        g.needed = g.fields = dem__shape_fields(w->engine->convex.shape, g.field);
        dem__write_group(s, w, &g, w->engine->convex.shapes, 0);
    }
    dem__write_particles(s, w, &g);
    dem__write_bodies(s, w, &g);
    dem__write_contacts(s, w, &g);
    if (w->engine->links.count > 0) dem__link_fields(w, &g), dem__write_group(s, w, &g, w->engine->links.count, 2);
    if (w->passed_count > 0) dem__passed_fields(w->passed, &g), dem__write_group(s, w, &g, w->passed_count, 0);
}

DEM_API size_t dem_save(const dem_world *world, void *buffer, size_t capacity) {
    dem__stream s = {NULL, NULL, 0};
    if (!world || !world->def.allocator.fn || dem__is_running(world)) return 0;
    dem_world w = *world; /* shares the arrays: tables of fields hold writable addresses, but nothing is written */
    dem__write_world(&s, &w);
    const size_t size = s.at + 8;
    if (!buffer || size > capacity) return size;
    s.to = (unsigned char *)buffer, s.at = 0;
    dem__write_world(&s, &w);
    uint64_t check = dem__checksum(s.to, s.at);
    dem__stream_u64(&s, &check);
    return size;
}

/* ---- hash ---- */

/* Adds a number of 8 bytes to an FNV-1a hash. */
DEM_INLINE void dem__hash_u64(uint64_t *hash, uint64_t v) {
    for (int k = 0; k < 8; k++) *hash = (*hash ^ (v >> (8 * k) & 255u)) * 0x100000001b3u;
}
static inline void dem__hash_i64(uint64_t *hash, int64_t v) { dem__hash_u64(hash, (uint64_t)v); }
static inline void dem__hash_f64(uint64_t *hash, const double *v, int n) {
    for (int k = 0; k < n; k++) {
        uint64_t bits;
        memcpy(&bits, &v[k], sizeof bits);
        dem__hash_u64(hash, bits);
    }
}
static inline void dem__hash_vec(uint64_t *hash, dem_vec v) {
    dem__hash_f64(hash, &v.x, 1), dem__hash_f64(hash, &v.y, 1), dem__hash_f64(hash, &v.z, 1);
}

static inline void dem__hash_particle(uint64_t *hash, const dem_world *w, ptrdiff_t i) {
    const dem__bodies *bodies = &w->engine->bodies;
    const dem_particle *p = &w->particle[i];
    dem__hash_vec(hash, p->x), dem__hash_vec(hash, p->v), dem__hash_vec(hash, p->a);
    dem__hash_vec(hash, p->spin), dem__hash_vec(hash, w->spin_rate[i]);
    dem__hash_f64(hash, &p->radius, 1), dem__hash_f64(hash, &p->mass, 1), dem__hash_f64(hash, bodies->load[i], 6);
    dem__hash_i64(hash, p->origin), dem__hash_u64(hash, w->id[i]);
    dem__hash_i64(hash, w->material[i]), dem__hash_i64(hash, w->group[i]);
    if (dem__is_fixed(w, i))
        dem__hash_f64(hash, bodies->fixed[i].load, 6), dem__hash_vec(hash, bodies->fixed[i].impulse);
    if (!w->engine->links.on) return;
    dem__hash_f64(hash, bodies->external[i], 6);
    dem__hash_i64(hash, w->engine->links.is_loaded[i]);
}

static inline void dem__hash_quaternion(uint64_t *hash, dem_quaternion q) {
    dem__hash_f64(hash, &q.w, 1), dem__hash_f64(hash, &q.x, 1), dem__hash_f64(hash, &q.y, 1),
        dem__hash_f64(hash, &q.z, 1);
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

/* Adds the bodies of a contact or a link, numbered among those present, and its element. */
static inline void dem__hash_bodies(uint64_t *hash, const dem_world *w, int32_t i, int32_t j, int32_t element) {
    const int32_t *number = w->engine->bodies.number;
    dem__hash_i64(hash, number[i]), dem__hash_i64(hash, j >= 0 ? number[j] : j), dem__hash_i64(hash, element);
}

DEM_API uint64_t dem_hash(const dem_world *world) {
    uint64_t hash = 0xcbf29ce484222325u;
    const dem_world *w = world;
    if (!w || !w->def.allocator.fn) return hash;
    const dem__contacts *contacts = &w->engine->contacts;
    const dem__links *links = &w->engine->links;
    dem__hash_i64(&hash, w->step);
    for (int k = 0; k < w->walls; k++) {
        const dem_wall *a = &w->wall[k];
        if (a->asked.drive >= DEM_FORCE_CONTROLLED)
            dem__hash_f64(&hash, &a->coordinate, 1), dem__hash_f64(&hash, &a->rate, 1);
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i]) dem__hash_particle(&hash, w, i);
    }
    for (ptrdiff_t k = 0; k < links->count; k++) {
        dem__hash_bodies(&hash, w, links->i[k], links->j[k], links->element[k]);
        for (int a = 0; a < links->states; a++) dem__hash_f64(&hash, &links->state[a][k], 1);
    }
    DEM__EACH_CONTACT(w, c) {
        dem__hash_bodies(&hash, w, contacts->i[c], contacts->j[c], contacts->element[c]);
        dem__hash_f64(&hash, &contacts->gap[c], 1), dem__hash_f64(&hash, &contacts->force[c], 1);
        for (int a = 0; a < contacts->states; a++) dem__hash_f64(&hash, &contacts->state[a][c], 1);
    }
    dem__hash_rigids(&hash, w);
    return hash;
}
