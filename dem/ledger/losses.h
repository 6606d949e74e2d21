/* What the ledger books for contacts: energy that they store and dissipate, work of walls, loads and fixed
   particles. */
#pragma once
#include "../contacts/contacts.h"

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

/* Books the work that fixed particle i does by its motion in a step, by the trapezoidal rule. */
static inline void dem__book_fixed(dem_world *w, ptrdiff_t i) {
    const dem__bodies *bodies = &w->engine->bodies;
    const double *now = bodies->sum[i].load, *before = bodies->fixed[i].load, half = 0.5 * w->engine->run.dt;
    for (int a = 0; a < 3; a++) {
        const double of_links = bodies->load[i][a] - bodies->external[i][a],
                     turning = bodies->load[i][3 + a] - bodies->external[i][3 + a];
        dem__book_work_of_fixed(w, -half * (before[a] + now[a] + of_links) * dem_axis(w->particle[i].v, a));
        dem__book_work_of_fixed(w, -half * (before[3 + a] + now[3 + a] + turning) * dem_axis(w->particle[i].spin, a));
    }
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
        if (dem__is_fixed(w, i)) {
            dem__book_fixed(w, i);
            continue;
        }
        l->external_work += w->engine->run.dt * dem__dot(dem__first(bodies->external[i]), w->particle[i].v);
        l->external_work += w->engine->run.dt * dem__dot(dem__second(bodies->external[i]), w->particle[i].spin);
    }
}
