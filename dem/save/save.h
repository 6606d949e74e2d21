/* Saving: writes the groups of save/fields.h as records. It only reads the world, so several threads may save the same
   one. */
#pragma once
#include "../particles/particles.h"
#include "fields.h"

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

static inline void dem__write_ranks(dem__stream *s, dem_world *w, dem__group *g) {
    const ptrdiff_t present = w->count - w->engine->bodies.dropped;
    if (present == 0) return;
    dem__rank_fields(w, g);
    dem__begin_record(s, &g->field[0], (uint64_t)present);
    for (ptrdiff_t r = 0; r < w->count; r++) {
        if (w->alive[w->engine->bodies.by_rank[r]]) dem__write_entry(s, w, &g->field[0], r, 1);
    }
}

static inline void dem__write_contacts(dem__stream *s, dem_world *w, dem__group *g) {
    const dem__contacts *contacts = &w->engine->contacts;
    dem__saved_chunk chunk[DEM__CHUNKS];
    int32_t rank = 0, present = 0; /* present: particles with a lower rank */
    for (int q = contacts->chunk_count - 1; q >= 0; q--) {
        for (; rank < contacts->chunk[q].first_rank && rank < (int32_t)w->count; rank++)
            present += w->alive[w->engine->bodies.by_rank[rank]] != 0;
        chunk[q].count = contacts->chunk[q].count, chunk[q].capacity = contacts->chunk[q].capacity;
        chunk[q].first_rank = present;
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
    dem_pair_def pair[DEM_MATERIALS_MAX * DEM_MATERIALS_MAX]; /* without gaps, because DEM_MATERIALS_MAX may change */
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
    dem__write_particles(s, w, &g);
    dem__write_ranks(s, w, &g);
    dem__write_contacts(s, w, &g);
    DEM__TELL(w, save, (s, w, &g));
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

static inline void dem__hash_particle(uint64_t *hash, const dem_world *w, ptrdiff_t i) {
    const dem__bodies *bodies = &w->engine->bodies;
    const dem_particle *p = &w->particle[i];
    dem__hash_vec(hash, p->x), dem__hash_vec(hash, p->v), dem__hash_vec(hash, p->a);
    dem__hash_vec(hash, p->spin), dem__hash_vec(hash, w->spin_rate[i]);
    dem__hash_f64(hash, &p->radius, 1), dem__hash_f64(hash, &p->mass, 1), dem__hash_f64(hash, bodies->load[i], 6);
    dem__hash_i64(hash, p->origin), dem__hash_u64(hash, w->id[i]);
    dem__hash_i64(hash, w->material[i]), dem__hash_i64(hash, w->group[i]);
    DEM__TELL(w, hash_particle, (hash, w, i));
}

DEM_API uint64_t dem_hash(const dem_world *world) {
    uint64_t hash = 0xcbf29ce484222325u;
    const dem_world *w = world;
    if (!w || !w->def.allocator.fn) return hash;
    const dem__contacts *contacts = &w->engine->contacts;
    dem__hash_i64(&hash, w->step);
    for (int k = 0; k < w->walls; k++) {
        const dem_wall *a = &w->wall[k];
        if (a->asked.drive >= DEM_FORCE_CONTROLLED)
            dem__hash_f64(&hash, &a->coordinate, 1), dem__hash_f64(&hash, &a->rate, 1);
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i]) dem__hash_particle(&hash, w, i);
    }
    DEM__TELL(w, hash_before_contacts, (&hash, w));
    DEM__EACH_CONTACT(w, c) {
        dem__hash_bodies(&hash, w, contacts->i[c], contacts->j[c], contacts->element[c]);
        dem__hash_f64(&hash, &contacts->gap[c], 1), dem__hash_f64(&hash, &contacts->force[c], 1);
        for (int a = 0; a < contacts->states; a++) dem__hash_f64(&hash, &contacts->state[a][c], 1);
    }
    DEM__TELL(w, hash, (&hash, w));
    DEM__TELL(w, hash, (&hash, w));
    return hash;
}
