/* Consequences of a removal of particles: the ends of their contacts, the numbers of those present. Reads bodies;
   writes contacts. Promises: a particle that has no contact left is in flight afterwards. */
#pragma once
#include "../contacts/contacts.h"

/* Removes the force of ended contacts from the acceleration of particles that touch nothing any more. */
static inline void dem__free_untouched(dem_world *w) {
    const dem__bodies *bodies = &w->engine->bodies;
    for (ptrdiff_t k = 0; k < bodies->active_count; k++) {
        if (!w->touching[bodies->active[k]]) dem__free_acceleration(w, bodies->active[k]);
    }
}

/* Numbers the particles present, after a removal. */
static inline void dem__number_present(dem_world *w) {
    int32_t n = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        w->engine->bodies.number[i] = n;
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
    if (!dem__is_present(w, i)) return DEM_BAD_ARGUMENT;
    w->engine->run.running = 1;
    dem__detach_particle(w, i);
    dem__end_contacts_of_removed(w);
    w->engine->run.running = 0;
    return DEM_OK;
}
