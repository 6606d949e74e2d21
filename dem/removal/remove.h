/* Particles that leave: by an exit, by dem_remove, or with a region. A removed particle is in no list; a particle that
   has lost its last contact is in flight. */
#pragma once
#include "../contacts/contacts.h"
#include "../regions/regions.h"

/* Removes particle i from all lists. Its entries in the arrays are removed by a later rebuild. */
static inline void dem__detach_one(dem_world *w, ptrdiff_t i) {
    dem__pairs *pairs = &w->engine->pairs;
    dem__book_removed(w, dem__motion_energy(w, i) + dem__potential(w, i), dem__potential(w, i));
    w->alive[i] = DEM_LEAVING; /* so that the law can distinguish a removal from a rupture */
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

/* Removes the force of ended contacts from the acceleration of particles that touch nothing else. */
static inline void dem__free_untouched(dem_world *w) {
    const dem__bodies *bodies = &w->engine->bodies;
    for (ptrdiff_t k = 0; k < bodies->active_count; k++) {
        if (!w->touching[bodies->active[k]]) dem__free_acceleration(w, bodies->active[k]);
    }
}

/* Numbers the particles present, after a removal. */
static inline void dem__number_present(dem_world *w) {
    const dem__bodies *bodies = &w->engine->bodies;
    int32_t n = 0, *by_number = w->engine->scratch.index;
    for (ptrdiff_t i = 0; i < w->count && bodies->by_place; i++) by_number[bodies->given[i]] = (int32_t)i;
    for (ptrdiff_t k = 0; k < w->count; k++) {
        const ptrdiff_t i = bodies->by_place ? by_number[k] : k;
        bodies->number[i] = n;
        n += w->alive[i] != 0;
    }
}

/* Ends the contacts of removed particles. */
static inline void dem__end_contacts_of_removed(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    DEM__EACH_CONTACT(w, c) {
        const int32_t j = contacts->j[c];
        if (!w->alive[contacts->i[c]] || (j >= 0 && !w->alive[j])) contacts->ended[c] = 1;
    }
    dem__number_present(w);
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    dem__remove_ended(w, w->step, 1);
    dem__free_untouched(w);
}

DEM_API dem_status dem_remove(dem_world *world, ptrdiff_t i) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (dem__lacks_particle(w, i)) return DEM_BAD_ARGUMENT;
    w->engine->run.running = 1;
    dem__detach_particle(w, i);
    dem__end_contacts_of_removed(w);
    w->engine->run.running = 0;
    return DEM_OK;
}

DEM_API ptrdiff_t dem_take_passed(dem_world *world, dem_passed *records, ptrdiff_t capacity) {
    dem_world *w = world;
    if (dem__is_running(w)) return -(ptrdiff_t)DEM_BUSY;
    if (dem__lacks_memory(w)) return -(ptrdiff_t)DEM_BAD_ARGUMENT;
    if (capacity < 0) return -(ptrdiff_t)dem__refuse(w, "capacity: below 0");
    const ptrdiff_t n = capacity < w->passed_count ? capacity : w->passed_count, left = w->passed_count - n;
    if (n == 0) return 0;
    if (records) memcpy(records, w->passed, (size_t)n * sizeof *records);
    memmove(w->passed, w->passed + n, (size_t)left * sizeof *records);
    w->passed_count = left;
    return n;
}

DEM_API ptrdiff_t dem_remove_region(dem_world *world, const dem_region *region) {
    if (dem__is_running(world)) return -(ptrdiff_t)DEM_BUSY;
    dem_world *w = world;
    ptrdiff_t removed = 0;
    if (dem__lacks_memory(w)) return -(ptrdiff_t)DEM_BAD_ARGUMENT;
    if (!dem__is_region(region))
        return -(ptrdiff_t)dem__refuse(w, "region: NULL, or a length, a place or an axis is out of range");
    w->engine->run.running = 1;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i] || !dem__leads(w, i) || !dem_region_holds(region, dem__centre_now(w, i))) continue;
        dem__detach_particle(w, i);
        removed++;
    }
    if (removed > 0) dem__end_contacts_of_removed(w);
    w->engine->run.running = 0;
    return removed;
}
