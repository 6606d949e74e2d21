/* The order of particles in memory. In a run with many contacts particles lie by rank, so that neighbours in space are
   neighbours in memory, whatever the order in which they were added. Before the run returns they lie by their numbers
   again. Reads ranks; moves all arrays of particles, and renumbers contacts and lists. Promises: no result depends on
   it, because sums follow the order of contacts, which follows ranks. */
#pragma once
#include "../contacts/order.h"

/* Copies the entries of particles first .. end-1 of an array from where they lie. */
static inline void dem__take_entries(char *to, const char *base, size_t size, const int32_t *from, ptrdiff_t first,
                                     ptrdiff_t end) {
    for (ptrdiff_t k = first; k < end; k++) {
        const char *entry = base + (size_t)from[k] * size;
        if (size == 4) memcpy(to + 4 * k, entry, 4);
        else if (size == sizeof(dem_vec)) memcpy(to + (size_t)k * sizeof(dem_vec), entry, sizeof(dem_vec));
        else if (size == sizeof(dem__bound)) memcpy(to + (size_t)k * sizeof(dem__bound), entry, sizeof(dem__bound));
        else if (size == sizeof(dem_particle))
            memcpy(to + (size_t)k * sizeof(dem_particle), entry, sizeof(dem_particle));
        else memcpy(to + (size_t)k * size, entry, size);
    }
}

/* An array that is being reordered. */
typedef struct dem__move {
    char *base, *scratch;
    size_t size;
    const int32_t *from;
} dem__move;
static inline void dem__take_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__move *m = (const dem__move *)context;
    (void)w, (void)part;
    dem__take_entries(m->scratch, m->base, m->size, m->from, first, end);
}
static inline void dem__put_back_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__move *m = (const dem__move *)context;
    (void)w, (void)part;
    memcpy(m->base + (size_t)first * m->size, m->scratch + (size_t)first * m->size, (size_t)(end - first) * m->size);
}

/* Returns whether an array of particles needs no move: scratch memory, lists that are rebuilt, loads that are all 0. */
static inline int dem__stays(const dem_world *w, const void *base) {
    const dem__bodies *bodies = &w->engine->bodies;
    return base == w->engine->scratch.index || base == w->engine->pairs.cell_of ||
           base == w->engine->pairs.adjacent_start || base == bodies->active || base == bodies->active_at ||
           base == bodies->to_check || base == bodies->by_rank ||
           (!bodies->loads_on && (base == bodies->load || base == bodies->external));
}

/* Reorders all arrays of particles: place k gets the entry at from[k]. */
static inline void dem__move_entries(dem_world *w, const int32_t *from) {
    dem__array list[DEM__ARRAYS_MAX];
    dem__timers *t = &w->engine->walls.timers;
    dem__move m;
    int n = dem__particle_arrays(w, list);
    const int parts = dem__parts(w, w->count);
    const size_t walls = (size_t)w->walls * sizeof(int32_t);
    m.from = from, m.scratch = (char *)w->engine->contacts.correction; /* free between steps */
    if (walls > 0 && !w->engine->run.needs_lists) {
        list[n].address = &t->due, list[n++].size = walls;
        list[n].address = &w->engine->walls.sure, list[n++].size = walls;
    }
    for (int k = 0; k < n; k++) {
        memcpy(&m.base, list[k].address, sizeof m.base);
        m.size = list[k].size;
        if (!m.base || dem__stays(w, m.base)) continue;
        dem__in_parts(w, parts, w->count, dem__take_range, &m);
        dem__in_parts(w, parts, w->count, dem__put_back_range, &m);
    }
    if (walls > 0 && !w->engine->run.needs_lists) dem__stop_timers(t, w->count * w->walls, w->count * w->walls);
}

/* Gives contacts and near pairs the new places of their particles. The order of the two stays. */
static inline void dem__rename_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const int32_t *to = (const int32_t *)context;
    dem__near *near = w->engine->pairs.near;
    (void)part;
    for (ptrdiff_t p = first; p < end; p++) near[p].i = to[near[p].i], near[p].j = to[near[p].j];
}
static inline void dem__rename_particles(dem_world *w, int32_t *to) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__pairs *pairs = &w->engine->pairs;
    DEM__EACH_CONTACT(w, c) {
        contacts->i[c] = to[contacts->i[c]];
        if (contacts->j[c] >= 0) contacts->j[c] = to[contacts->j[c]];
    }
    if (w->engine->run.needs_lists) return;
    dem__in_parts(w, dem__parts(w, pairs->count / 4), pairs->count, dem__rename_range, to);
    dem__find_adjacent(w); /* cannot fail: there are as many pairs as before */
}

/* Reorders particles in memory. from: pairs.cell_of, the places where they lie. */
static DEM__NOINLINE void dem__put_in_order(dem_world *w, const int32_t *from) {
    dem__bodies *bodies = &w->engine->bodies;
    int32_t *to = w->engine->scratch.index;
    for (ptrdiff_t k = 0; k < w->count; k++) to[from[k]] = (int32_t)k;
    dem__move_entries(w, from);
    for (ptrdiff_t r = 0; r < w->count; r++) bodies->by_rank[r] = to[bodies->by_rank[r]];
    dem__rename_particles(w, to);
    dem__list_active(w);
}

/* Sorts particles by rank. */
static inline void dem__lie_by_rank(dem_world *w) {
    dem__bodies *bodies = &w->engine->bodies;
    int32_t *from = w->engine->pairs.cell_of;
    for (ptrdiff_t k = 0; k < w->count && !bodies->by_place; k++) bodies->given[k] = (int32_t)k;
    for (ptrdiff_t k = 0; k < w->count; k++) from[k] = bodies->by_rank[k];
    bodies->by_place = 1;
    dem__put_in_order(w, from);
}

/* Sorts particles by number. */
static inline void dem__lie_by_number(dem_world *w) {
    dem__bodies *bodies = &w->engine->bodies;
    int32_t *from = w->engine->pairs.cell_of;
    if (!bodies->by_place) return;
    for (ptrdiff_t k = 0; k < w->count; k++) from[bodies->given[k]] = (int32_t)k;
    dem__put_in_order(w, from);
    bodies->by_place = 0;
}

/* Returns whether particles may lie in any order during a run of this kernel: only the engine reads them, because no
   functions of the caller are called, and every feature allows it. */
static inline int dem__may_lie_by_rank(const dem_world *w, const dem_kernel *kernel) {
    for (int k = 0; k < w->engine->features; k++) {
        if (!w->engine->feature[k].sorts) return 0;
    }
    for (int k = 0; k < w->walls; k++) {
        if (w->wall[k].asked.motion) return 0;
    }
    return !kernel->law->born && !kernel->law->ended && w->engine->contacts.chunk_count > 1 &&
           (size_t)w->engine->contacts.capacity * sizeof(dem__correction) >= (size_t)w->count * sizeof(dem_particle);
}

/* Returns whether neighbours by rank are so often far apart in memory that it pays to move them, for a run of `steps`
   more steps. */
static inline int dem__pays_to_move(const dem_world *w, int64_t steps) {
    const int32_t *by_rank = w->engine->bodies.by_rank;
    ptrdiff_t apart = 0, far = 0;
    if (steps < DEM__MOVE_STEPS) return 0;
    for (ptrdiff_t r = 1; r < w->count; r++) {
        const int32_t d = by_rank[r] - by_rank[r - 1];
        apart += d > 8 || d < -8;
        far += d > 1024 || d < -1024;
    }
    return 4 * far > w->count || (4 * apart > w->count && steps >= 4 * DEM__MOVE_STEPS);
}

/* Sorts particles by rank if it pays. steps: left in this run. */
static inline void dem__order_memory(dem_world *w, const dem_kernel *kernel, int64_t steps) {
    if (dem__may_lie_by_rank(w, kernel) && dem__pays_to_move(w, steps)) dem__lie_by_rank(w);
}
