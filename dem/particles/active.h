/* Lists of active particles, and removal of dropped particles from the arrays. */
#pragma once
#include "ranks.h"

/* After changes by the caller, begins flights of particles that nothing touches or loads. */
static inline void dem__release_unloaded(dem_world *w) {
    dem__bodies *bodies = &w->engine->bodies;
    for (ptrdiff_t i = 0; i < w->count && bodies->loads_on; i++) {
        if (!bodies->activity[i] || !w->alive[i] || w->touching[i] > 0 || dem__is_loaded(w, i)) continue;
        dem__free_acceleration(w, i);
        bodies->activity[i] = DEM__FLYING;
    }
}

/* Lists active particles in the order of memory. */
static inline void dem__list_active(dem_world *w) {
    dem__bodies *bodies = &w->engine->bodies;
    bodies->active_count = bodies->to_check_count = 0;
    for (int32_t i = 0; i < (int32_t)w->count; i++) {
        bodies->active[bodies->active_count] = i, bodies->active_at[i] = (int32_t)bodies->active_count;
        bodies->active_count += bodies->activity[i] != 0;
        if (bodies->activity[i] == 2) bodies->to_check[bodies->to_check_count++] = i;
    }
}

/* Moves the wall timers of the `left` particles that stay to their new numbers, which are in scratch.index. */
static inline void dem__move_wall_timers(dem_world *w, ptrdiff_t left) {
    dem__wall_state *walls = &w->engine->walls;
    dem__timers *t = &walls->timers;
    if (w->engine->run.needs_lists) return; /* they are rebuilt */
    for (ptrdiff_t i = 0; i < w->count; i++) {
        for (int k = 0; k < w->walls && w->engine->scratch.index[i] >= 0; k++) {
            t->due[w->engine->scratch.index[i] * w->walls + k] = t->due[i * w->walls + k];
            walls->sure[w->engine->scratch.index[i] * w->walls + k] = walls->sure[i * w->walls + k];
        }
    }
    dem__stop_timers(t, left * w->walls, left * w->walls);
}

DEM_INLINE void dem__close_gaps(char *base, size_t size, const int32_t *remap, ptrdiff_t first, ptrdiff_t count) {
    for (ptrdiff_t i = first; i < count; i++) {
        if (remap[i] >= 0) memcpy(base + (size_t)remap[i] * size, base + (size_t)i * size, size);
    }
}

/* Closes the gaps in the order of particles, and in the ranks at which chunks begin. Called before the arrays are
   moved. */
static inline void dem__close_ranks(dem_world *w, const int32_t *remap) {
    dem__contacts *contacts = &w->engine->contacts;
    int32_t *by_rank = w->engine->bodies.by_rank, left = 0;
    int q = contacts->chunk_count - 1; /* the last chunk begins with the first rank */
    for (int32_t r = 0; r < (int32_t)w->count; r++) {
        for (; q >= 0 && contacts->chunk[q].first_rank == r; q--) contacts->chunk[q].first_rank = left;
        if (remap[by_rank[r]] >= 0) by_rank[left++] = remap[by_rank[r]];
    }
    for (; q >= 0; q--) contacts->chunk[q].first_rank = left;
}

/* Removes dropped particles from the arrays. The others keep their order. */
static inline void dem__compact(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    if (!w->engine->bodies.dropped) return;
    ptrdiff_t to = 0;
    dem__array list[DEM__ARRAYS_MAX];
    int n = dem__particle_arrays(w, list);
    for (ptrdiff_t i = 0; i < w->count; i++) w->engine->scratch.index[i] = w->alive[i] ? (int32_t)to++ : -1;
    int32_t *remap = w->engine->scratch.index;
    ptrdiff_t first = 0;
    dem__close_ranks(w, remap);
    while (first < w->count && remap[first] == first) first++;
    for (int k = 0; k < n; k++) {
        char *base;
        memcpy(&base, list[k].address, sizeof base);
        if ((void *)base == (void *)remap || (void *)base == (void *)w->engine->bodies.by_rank) continue;
        if (list[k].size == sizeof(double)) dem__close_gaps(base, sizeof(double), remap, first, w->count);
        else if (list[k].size == sizeof(int32_t)) dem__close_gaps(base, sizeof(int32_t), remap, first, w->count);
        else dem__close_gaps(base, list[k].size, remap, first, w->count);
    }
    dem__move_wall_timers(w, to);
    DEM__EACH_CONTACT(w, c) {
        contacts->i[c] = remap[contacts->i[c]];
        if (contacts->j[c] >= 0) contacts->j[c] = remap[contacts->j[c]];
    }
    w->count = to;
    for (ptrdiff_t i = 0; i < to && w->engine->bodies.by_place; i++)
        w->engine->bodies.given[i] = w->engine->bodies.number[i];
    dem__set_ranks(w);
    w->engine->bodies.dropped = 0;
    DEM__TELL(w, renumber, (w, remap));
}
