/* Particles that leave, and their links, which end with them. Reads bodies, walls, pairs; writes links and lists.
   Promises: a particle that is gone is in no list. */
#pragma once
#include "../search/neighbour_list.h"

/* Removes link k from particle i's list, or puts another link in its place. */
static inline void dem__unlist_link(dem_world *w, int32_t k, int32_t i, int32_t replacement) {
    dem__links *links = &w->engine->links;
    int32_t *at = &links->first_link[i];
    while (*at != k) at = links->i[*at] == i ? &links->next_i[*at] : &links->next_j[*at];
    *at = replacement >= 0 ? replacement : dem__next_link(w, k, i);
}

/* Returns the highest slot of a particle's links. The order of its list depends on the history of the scene. */
static inline int32_t dem__last_link(const dem_world *w, ptrdiff_t i) {
    int32_t last = -1;
    for (int32_t k = w->engine->links.first_link[i]; k >= 0; k = dem__next_link(w, k, i)) last = k > last ? k : last;
    return last;
}

/* Calls the law's hook for a contact or a link that has ended. */
static inline void dem__report_end(dem_world *w, const dem_law *law, int32_t k) {
    if (!law || !law->ended) return;
    w->engine->run.ending = 1;
    law->ended(w, k, w->user);
    w->engine->run.ending = 0;
}

/* Ends link k; the last link takes its slot. Its force acts until links are evaluated next. */
static inline void dem__cut_link(dem_world *w, int32_t k) {
    const int32_t i = w->engine->links.i[k], j = w->engine->links.j[k], last = (int32_t)w->engine->links.count - 1;
    dem__report_end(w, w->engine->links.law, k);
    dem__unlist_link(w, k, i, -1);
    if (j >= 0) {
        const int32_t p = dem__near_pair(w, i, j);
        dem__mark_link(w, p, 0);
        dem__unlist_link(w, k, j, -1);
    }
    w->engine->links.count = last;
    if (k == last) return;
    dem__unlist_link(w, last, w->engine->links.i[last], k);
    if (w->engine->links.j[last] >= 0) dem__unlist_link(w, last, w->engine->links.j[last], k);
    dem__array list[DEM__ARRAYS_MAX];
    const int n = dem__link_arrays(w, list);
    for (int a = 0; a < n; a++) {
        char *base;
        memcpy(&base, list[a].address, sizeof base);
        memcpy(base + (size_t)k * list[a].size, base + (size_t)last * list[a].size, list[a].size);
    }
}

/* Marks an active particle for dem__check_bounds. */
DEM_INLINE void dem__mark_one(dem_world *w, ptrdiff_t i) {
    dem__bodies *bodies = &w->engine->bodies;
    if (bodies->activity[i] != 1) return;
    bodies->activity[i] = 2;
    bodies->to_check[bodies->to_check_count++] = (int32_t)i;
}
/* Marks particle i, or all particles of its rigid body. */
DEM_INLINE void dem__mark_to_check(dem_world *w, ptrdiff_t i) {
    const dem__pieces own = dem__pieces_of(w, i);
    for (ptrdiff_t k = own.first; k < own.end; k++) dem__mark_one(w, k);
}

/* Removes particle i from all lists. Its entries in the arrays are removed by a later rebuild. */
static inline void dem__detach_one(dem_world *w, ptrdiff_t i) {
    dem__pairs *pairs = &w->engine->pairs;
    dem__book_link_work(w, dem__link_work(w, i));
    dem__book_removed(w, dem__motion_energy(w, i) + dem__potential(w, i), dem__potential(w, i));
    w->alive[i] = DEM_LEAVING; /* so that the law can tell a removal from a rupture */
    while (w->engine->links.first_link[i] >= 0) dem__cut_link(w, dem__last_link(w, i));
    w->engine->links.is_loaded[i] = 0; /* the work of its links has been booked */
    w->alive[i] = 0;
    w->engine->bodies.dropped++;
    dem__mark_to_check(w, i);
    if (w->engine->run.needs_lists) return;
    for (int32_t a = pairs->adjacent_start[i]; a < pairs->adjacent_start[i + 1]; a++) {
        dem__stop_timer(&pairs->timers, pairs->adjacent[2 * a]);
    }
    for (int k = 0; k < w->walls; k++) dem__stop_timer(&w->engine->walls.timers, (int32_t)i * w->walls + k);
}

/* Removes particle i, or all particles of its rigid body, from all lists. */
static inline void dem__detach_particle(dem_world *w, ptrdiff_t i) {
    const dem__pieces own = dem__pieces_of(w, i);
    for (ptrdiff_t k = own.first; k < own.end; k++) dem__detach_one(w, k);
}
