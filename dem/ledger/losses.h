/* What the ledger books for contacts: energy that they store and dissipate, work of walls, loads and fixed
   particles. */
#pragma once
#include "../contacts/contacts.h"
#include "../motion/fixed.h"

/* Books the energy that the contact in slot c stores at its end: as removed if the caller or an exit ended it,
   otherwise as sliding loss, because its tangential spring is released. */
static inline void dem__book_contact_end(dem_world *w, ptrdiff_t c) {
    const int32_t i = w->engine->contacts.i[c], j = w->engine->contacts.j[c];
    dem_energy_ledger *sums = &w->engine->ledger.sums;
    if (!w->engine->ledger.counts) return;
    if (w->alive[i] <= 0 || (j >= 0 && w->alive[j] <= 0) || dem__is_taken_away(w, i, j))
        sums->removed += w->engine->contacts.elastic[c];
    else sums->sliding_loss += w->engine->contacts.elastic[c];
}

/* Returns the energy stored in all contacts [J]; 0 without a ledger. */
static inline double dem__stored_energy(const dem_world *w) {
    double sum = 0.0;
    if (!w->engine->ledger.counts) return sum;
    DEM__EACH_CONTACT(w, c) { sum += w->engine->contacts.elastic[c]; }
    return sum;
}

/* Books what contacts dissipated in a step, and the work of walls and loads. */
static inline void dem__book_losses(dem_world *w) {
    const dem__bodies *bodies = &w->engine->bodies;
    const dem__contacts *contacts = &w->engine->contacts;
    dem_energy_ledger *l = &w->engine->ledger.sums;
    DEM__EACH_CONTACT(w, k) {
        l->normal_loss += contacts->loss[0][k];
        l->sliding_loss += contacts->loss[1][k];
        l->rolling_loss += contacts->loss[2][k];
        l->wall_work += contacts->loss[3][k];
    }
    for (ptrdiff_t k = 0; bodies->loads_on && k < bodies->active_count; k++) {
        const ptrdiff_t i = bodies->active[k];
        if (dem__work_as_fixed(w, i)) continue;
        l->external_work += w->engine->run.dt * dem__dot(dem__first(bodies->external[i]), w->particle[i].v);
        l->external_work += w->engine->run.dt * dem__dot(dem__second(bodies->external[i]), w->particle[i].spin);
    }
}
