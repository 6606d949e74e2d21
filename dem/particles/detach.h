/* Particles that leave. Reads bodies, walls, pairs; writes lists.
   Promises: a particle that is gone is in no list. */
#pragma once
#include "../search/neighbour_list.h"

/* Calls the law's hook for a contact or a link that has ended. */
static inline void dem__report_end(dem_world *w, const dem_law *law, int32_t k) {
    if (!law || !law->ended) return;
    w->engine->run.ending = 1;
    law->ended(w, k, w->user);
    w->engine->run.ending = 0;
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
    dem__book_removed(w, dem__motion_energy(w, i) + dem__potential(w, i), dem__potential(w, i));
    w->alive[i] = DEM_LEAVING; /* so that the law can tell a removal from a rupture */
    DEM__TELL(w, remove_particle, (w, i));
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
