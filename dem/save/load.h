/* Loading: makes a world from the records that save/save.h writes, and trusts none of them. Every index, count and
   number on which the engine relies is checked here. */
#pragma once
#include "../gas/flights.h"
#include "../ledger/ledger.h"
#include "../links/links.h"
#include "../meshes/add.h"
#include "../polyhedra/add.h"
#include "../walls/kinds.h"
#include "fields.h"

/* Reads contacts into their slots. Returns 0 if the file is not valid. */
static inline int dem__read_contacts(const dem__file *file, dem_world *w, dem__group *g) {
    if (w->engine->contacts.count == 0) return 1;
    dem__contact_fields(w, g);
    for (int q = 0; q < g->fields; q++) {
        dem__stream s;
        const int found = dem__find_field(file, g, q, w->engine->contacts.count, &s);
        if (found < 0) return 0;
        if (!found) continue;
        DEM__EACH_CONTACT(w, c) { dem__stream_entry(&s, &g->field[q], c); }
    }
    return 1;
}

/* Steps that a run may owe: half a step, and more after a change of the time step. */
#define DEM__OWED_STEPS 1e5

/* Reads materials and their pairs. Files have as many as the world; older ones have as many as the DEM_MATERIALS_MAX of
   the program that wrote them. Returns 0 if the file is not valid. */
static inline int dem__read_materials(const dem__file *file, dem_world *w, dem__group *g) {
    const ptrdiff_t used = w->def.materials, n = dem__entries_of(file, "material.density");
    if (used < 1 || used > DEM_MATERIALS_MAX || n < used || n > INT16_MAX) return 0;
    dem__material_fields(w->def.material, g);
    if (!dem__read_some(file, g, n, 0, used, 0)) return 0;
    dem__pair_fields(&w->def.pair[0][0], g);
    for (ptrdiff_t a = 0; a < used; a++) {
        /* still older files do not tell which pairs were set */
        for (ptrdiff_t b = 0; b < used; b++) w->def.pair[a][b].given = 1;
        if (!dem__read_some(file, g, n * n, a * n, a * n + used, a * DEM_MATERIALS_MAX)) return 0;
    }
    return 1;
}

/* Reads the definition and single numbers. Returns 0 if the file is not valid. */
static inline int dem__read_world(const dem__file *file, dem_world *w, dem__group *g) {
    dem__engine *e = w->engine;
    dem__world_fields(w, g);
    if (!dem__read_group(file, g, 1) || !dem__read_materials(file, w, g)) return 0;
    const int64_t counts[] = {w->step,  e->run.start_step, w->particle_steps, w->contact_steps,
                              w->looks, w->rebuilds,       w->passed_total};
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        if (!(counts[k] >= 0 && counts[k] < INT64_MAX / 4)) return 0;
    }
    if (!dem__is_flag(e->contacts.has_history) || !(fabs(w->owed) <= DEM__OWED_STEPS * w->def.dt)) return 0;
    if (e->contacts.states < 0 || e->contacts.states > DEM_STATE_MAX) return 0;
    for (int k = e->features - 1; k >= 0; k--) {
        const dem__feature *f = &e->feature[k];
        const int used = f->is_used(file, w);
        if (used < 0) return 0;
        if (!used) dem__drop_feature(w, f->place);
    }
    e->run.dt = w->def.dt;
    e->run.has_periodic = w->def.periodic[0] | w->def.periodic[1] | w->def.periodic[2];
    if (!dem__is_thread_count(w->def.threads)) w->def.threads = 1; /* the caller of the saved world changed it */
    return dem__bad_field(&w->def) == NULL;
}

/* Reads the triangles of a mesh, and rebuilds its tree. */
static inline dem_status dem__read_mesh(const dem__file *file, const dem_allocator *memory, int wall, dem_wall *a,
                                        dem__group *g) {
    dem__group triangles;
    dem_status status = DEM_OK;
    dem__mesh_fields(NULL, NULL, wall, g, &triangles);
    const ptrdiff_t n = dem__entries_of(file, g->field[0].name), m = dem__entries_of(file, triangles.field[0].name);
    const size_t bytes = (size_t)n * sizeof(dem_vec) + 3 * (size_t)m * sizeof(int32_t);
    if (n < 1 || m < 1) return DEM_BAD_DATA;
    dem_vec *vertex = (dem_vec *)memory->fn(memory->user, NULL, 0, bytes);
    if (!vertex) return DEM_OUT_OF_MEMORY;
    int32_t *corner = (int32_t *)(void *)(vertex + n);
    dem__mesh_fields(vertex, corner, wall, g, &triangles);
    if (!dem__read_group(file, g, n) || !dem__read_group(file, &triangles, m)) status = DEM_BAD_DATA;
    for (ptrdiff_t k = 0; k < n && status == DEM_OK; k++) {
        if (!(fabs(vertex[k].x) < 1e50 && fabs(vertex[k].y) < 1e50 && fabs(vertex[k].z) < 1e50)) status = DEM_BAD_DATA;
    }
    for (ptrdiff_t k = 0; k < 3 * m && status == DEM_OK; k++) {
        if (corner[k] < 0 || corner[k] >= n) status = DEM_BAD_DATA;
    }
    if (status == DEM_OK) a->tree = dem__make_tree(memory, n, vertex, m, corner, &status);
    memory->fn(memory->user, vertex, bytes, 0);
    return status == DEM_BAD_ARGUMENT ? DEM_BAD_DATA : status;
}

/* Returns whether a loaded wall could result from the functions that make and move walls. */
static inline int dem__is_sound_wall(const dem_world *w, const dem_wall *a) {
    const dem_wall_motion *asked = &a->asked;
    if (a->material < 0 || a->material >= w->def.materials || !a->kind__) return 0;
    if (!dem__is_flag(a->solid) || (a->solid && !dem__has(a, DEM__TRIANGULATED))) return 0;
    if (a->kind__->is_sound && !a->kind__->is_sound(a)) return 0;
    if (asked->drive < DEM_KINEMATIC || asked->drive > DEM_TORQUE_CONTROLLED) return 0;
    if (asked->drive == DEM_PRESCRIBED && !(asked->interval > 0.0)) return 0;
    return asked->drive < DEM_FORCE_CONTROLLED || asked->inertia > 0.0;
}

static inline dem_status dem__read_walls(const dem__file *file, dem_world *w, dem__group *g) {
    dem__wall_state *walls = &w->engine->walls;
    const ptrdiff_t n = dem__entries_of(file, "wall.kind");
    if (n > DEM_WALLS_MAX) return DEM_BAD_DATA;
    if (!dem__grow_walls(w, n)) return DEM_OUT_OF_MEMORY;
    for (ptrdiff_t k = 0; k < n; k++) w->wall[k].groups = ~(uint32_t)0;
    dem__wall_fields(w->wall, g);
    if (!dem__read_group(file, g, n)) return DEM_BAD_DATA;
    for (w->walls = 0; w->walls < n; w->walls++) {
        dem_wall *a = &w->wall[w->walls];
        a->kind__ = dem__find_kind(a->kind);
        if (!dem__is_sound_wall(w, a)) return DEM_BAD_DATA;
        const int is_mesh = dem__has(a, DEM__TRIANGULATED);
        const dem_status status = is_mesh ? dem__read_mesh(file, &w->def.allocator, w->walls, a, g) : DEM_OK;
        if (status != DEM_OK) return status;
        if (is_mesh) dem__add_feature(w, dem__feature_meshes());
        walls->touch_keepers += dem__has(a, DEM__TRIANGULATED | DEM__KEEPS_CURVATURE);
        walls->controls |= a->asked.drive >= DEM_FORCE_CONTROLLED;
        dem__set_phase_sine(a);
    }
    return DEM_OK;
}

/* Reads how contacts are distributed over chunks. Returns 0 if the file is not valid. */
static inline int dem__read_chunks(const dem__file *file, dem_world *w, dem__group *g, int64_t present) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__saved_chunk chunk[DEM__CHUNKS];
    const ptrdiff_t n = dem__entries_of(file, "chunk.count"), all = dem__entries_of(file, "contact.i");
    ptrdiff_t first = 0, left = all;
    if (n < 1 || n > DEM__CHUNKS) return 0;
    dem__chunk_fields(chunk, g);
    if (!dem__read_group(file, g, n)) return 0;
    for (ptrdiff_t q = 0; q < n; q++) {
        const int64_t count = chunk[q].count, capacity = chunk[q].capacity;
        const int is_last = q == n - 1;
        if (count < 0 || count > left || capacity < 0 || capacity > 64 * (all + DEM__BLOCK + present)) return 0;
        if (!is_last && count > capacity) return 0;
        contacts->chunk[q].first = first, contacts->chunk[q].count = (ptrdiff_t)count,
        contacts->chunk[q].capacity = (ptrdiff_t)capacity;
        contacts->chunk[q].first_rank = is_last ? 0 : chunk[q].first_rank;
        first += (ptrdiff_t)capacity, left -= (ptrdiff_t)count;
    }
    contacts->chunk_count = (int)n;
    contacts->count = all;
    return left == 0;
}

/* Reads the order of particles. Returns 0 if it does not contain each of them once. */
static inline int dem__read_ranks(const dem__file *file, dem_world *w, dem__group *g) {
    dem__bodies *bodies = &w->engine->bodies;
    if (w->count == 0) return 1;
    dem__rank_fields(w, g);
    if (!dem__read_group(file, g, w->count)) return 0;
    for (ptrdiff_t i = 0; i < w->count; i++) bodies->rank[i] = -1;
    for (ptrdiff_t r = 0; r < w->count; r++) {
        const int32_t i = bodies->by_rank[r];
        if (i < 0 || i >= w->count || bodies->rank[i] >= 0) return 0;
        bodies->rank[i] = (int32_t)r;
    }
    return 1;
}

/* Returns whether every contact lies in the chunk of its rank or in the last one. */
static inline int dem__are_sound_chunks(const dem_world *w) {
    const dem__contacts *contacts = &w->engine->contacts;
    int32_t before = INT32_MAX;
    for (int q = 0; q < contacts->chunk_count - 1; q++) {
        const dem__chunk *in = &contacts->chunk[q];
        if (in->first_rank < 0 || in->first_rank > before) return 0;
        for (ptrdiff_t c = in->first; c < in->first + in->count; c++) {
            const int32_t low = dem__rank_in_slot(w, c);
            if (low < in->first_rank || low >= before) return 0;
        }
        before = in->first_rank;
    }
    return 1;
}

/* Makes room for what a file contains, and sets the counts. Returns 0 when out of memory. */
static inline int dem__make_loaded_room(dem_world *w, ptrdiff_t present, ptrdiff_t passed) {
    dem__engine *e = w->engine;
    dem__array list[DEM__ARRAYS_MAX];
    const ptrdiff_t live = e->contacts.count;
    e->contacts.count = 0; /* growing has nothing to keep yet */
    if (!dem__grow_group(w, list, dem__particle_arrays(w, list), &e->bodies.block, &e->bodies.bytes,
                         &e->bodies.capacity, present + 1))
        return 0;
    if (!dem__grow_contacts(w, dem__next_slot(w) + 1) || !dem__fit_wall_forces(w, e->contacts.chunk_count)) return 0;
    if (passed > 0) {
        w->passed =
            (dem_passed *)w->def.allocator.fn(w->def.allocator.user, NULL, 0, (size_t)passed * sizeof *w->passed);
        if (!w->passed) return 0;
        memset(w->passed, 0, (size_t)passed * sizeof *w->passed);
        e->bodies.passed_capacity = passed;
    }
    w->count = present, w->passed_count = passed;
    e->contacts.count = live;
    return 1;
}

/* Reads particles, contacts, links and records of exits. */
static inline dem_status dem__read_state(const dem__file *file, dem_world *w, dem__group *g) {
    const ptrdiff_t present = dem__entries_of(file, "particle.x");
    if (!dem__read_chunks(file, w, g, present)) return DEM_BAD_DATA;
    if (!dem__make_loaded_room(w, present, dem__entries_of(file, "passed.time"))) return DEM_OUT_OF_MEMORY;
    dem__particle_fields(w, g);
    for (ptrdiff_t i = 0; i < present; i++) {
        w->alive[i] = 1;
        w->engine->bodies.number[i] = (int32_t)i;
        w->engine->walls.first_contact[i] = -1;
        DEM__TELL(w, add_particle, (w, i));
    }
    if (!dem__read_group(file, g, present) || !dem__read_ranks(file, w, g) || !dem__read_contacts(file, w, g))
        return DEM_BAD_DATA;
    dem_status status = DEM_OK;
    DEM__CHECK(w, status, load, (file, w, g));
    if (status != DEM_OK) return status;
    if (w->passed_count > 0) dem__passed_fields(w->passed, g);
    return w->passed_count == 0 || dem__read_group(file, g, w->passed_count) ? DEM_OK : DEM_BAD_DATA;
}

static inline int dem__are_sound_particles(const dem_world *w) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_particle *p = &w->particle[i];
        if (!dem__positive(p->radius) || !dem__positive(p->mass) || p->origin > w->step || p->origin < 0) return 0;
        if (w->material[i] < 0 || w->material[i] >= w->def.materials || (i > 0 && w->id[i] <= w->id[i - 1])) return 0;
    }
    return 1;
}

/* Returns whether the bodies and elements of contacts and links exist, and no contact exists twice. */
static inline int dem__are_sound_contacts(const dem_world *w) {
    const dem__contacts *contacts = &w->engine->contacts;
    ptrdiff_t n = 0;
    DEM__EACH_CONTACT(w, c) {
        const int32_t i = contacts->i[c], j = contacts->j[c];
        if (!dem__are_bodies(w, i, j) || (j >= 0 && j < i)) return 0;
        if (j < 0 && dem__has(&w->wall[-1 - j], DEM__TRIANGULATED) && !dem__shape_of(w, i) &&
            (contacts->element[c] < 0 || contacts->element[c] >= DEM__NUMBERS))
            return 0;
        if (w->particle[i].origin != w->step || (j >= 0 && w->particle[j].origin != w->step)) return 0;
        contacts->slots[n++] = (int32_t)c;
    }
    if (!dem__are_sound_chunks(w)) return 0;
    dem__sort(w, contacts->slots, n); /* no contact exists twice */
    for (ptrdiff_t c = 1; c < n; c++) {
        if (!dem__before(w, contacts->slots[c - 1], contacts->slots[c])) return 0;
    }
    return 1;
}

/* Derives from the rest what is not saved: lists of contacts, activity. */
static inline void dem__derive_loaded(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    int32_t *first = w->engine->walls.first_contact;
    w->engine->run.needs_lists = w->engine->run.keeps_wrenches = 1;
    DEM__TELL(w, loaded, (w));
    DEM__EACH_CONTACT(w, c) {
        const int32_t i = contacts->i[c], j = contacts->j[c];
        contacts->near[c] = -1; /* until the list is built */
        dem__activate(w, i);
        if (j >= 0) dem__activate(w, j);
        else contacts->wall_next[c] = first[i], first[i] = (int32_t)c;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dem__set_inverse_mass(w, i);
        if (!dem__is_loaded(w, i) || w->engine->bodies.activity[i]) continue;
        dem__wake(w, i);
        dem__set_mass_share(w, i);
    }
}

/* Adds every feature that a file may contain. A loaded world keeps those that it uses. */
static inline void dem__expect_features(dem_world *w) {
    dem__add_ledger(w);
    dem__add_feature(w, dem__feature_links());
    dem__add_feature(w, dem__feature_field());
    dem__add_feature(w, dem__feature_fixed());
    dem__add_feature(w, dem__feature_bodies());
    dem__add_feature(w, dem__feature_polyhedra());
}

/* Fills an empty world from a file. */
static inline dem_status dem__read_file(const dem__file *file, dem_world *w) {
    dem__group g;
    if (!dem__read_world(file, w, &g)) return DEM_BAD_DATA;
    dem_status status = dem__read_walls(file, w, &g);
    DEM__CHECK(w, status, load_first, (file, w, &g));
    if (status == DEM_OK) status = dem__read_state(file, w, &g);
    if (status != DEM_OK) return status;
    if (!dem__are_sound_particles(w) || !dem__are_sound_contacts(w)) return DEM_BAD_DATA;
    dem__derive_loaded(w);
    return DEM_OK;
}

DEM_API dem_status dem_load(dem_world *world, const void *buffer, size_t size, const dem_allocator *allocator) {
    dem__file file;
    if (!world || !buffer) return dem__refuse(world, "buffer: NULL");
    memset(world, 0, sizeof *world);
    if (!dem__open_file(&file, buffer, size)) return DEM_BAD_DATA;
    world->def = dem_default_def();
    if (allocator) world->def.allocator = *allocator;
    if (!dem__make_engine(world)) {
        memset(world, 0, sizeof *world);
        return DEM_OUT_OF_MEMORY;
    }
    dem__expect_features(world);
    const dem_status status = dem__read_file(&file, world);
    if (status != DEM_OK) dem_free(world);
    return status;
}
