/* Every posting of the energy ledger. Reads contacts and bodies; writes the ledger. Promises: nothing else adds to its
   sums, but step/step.h sets where they start. */
#pragma once
#include "../base/arrays.h"
#include "../walls/kind.h"

/* Returns the first of two vectors: the force of a wrench. */
DEM_INLINE dem_vec dem__first(const double *six) { return dem_vec3(six[0], six[1], six[2]); }
/* Returns the second one: the torque of a wrench. */
DEM_INLINE dem_vec dem__second(const double *six) { return dem_vec3(six[3], six[4], six[5]); }

/* Books the potential energy that a particle gains where it is put back into the periodic box [J]. */
DEM_INLINE void dem__book_wrap(dem_world *w, double raised) {
    if (w->engine->ledger.on) w->engine->ledger.sums.added += raised, w->engine->ledger.sums.added_potential += raised;
}

/* Books the potential energy of a particle that is added at rest [J]. */
DEM_INLINE void dem__book_added(dem_world *w, double potential) { dem__book_wrap(w, potential); }

/* Books the potential energy that a particle gains where the caller changes gravity [J]. */
DEM_INLINE void dem__book_gravity(dem_world *w, double raised) { dem__book_wrap(w, raised); }

/* Books a change of a particle's kinetic energy by the caller [J]. */
DEM_INLINE void dem__book_motion(dem_world *w, double change) {
    if (w->engine->ledger.on) w->engine->ledger.sums.added += change;
}

/* Books the energy of a particle that is removed, and its potential part [J]. */
DEM_INLINE void dem__book_removed(dem_world *w, double energy, double potential) {
    if (w->engine->ledger.on)
        w->engine->ledger.sums.removed += energy, w->engine->ledger.sums.removed_potential += potential;
}

/* Books work of links [J]. */
DEM_INLINE void dem__book_link_work(dem_world *w, double work) {
    if (w->engine->ledger.on) w->engine->ledger.sums.link_work += work;
}

/* Books work of a force field [J]. */
DEM_INLINE void dem__book_field_work(dem_world *w, double work) {
    if (w->engine->ledger.on) w->engine->ledger.sums.field_work += work;
}

/* Returns whether the caller ended the contact of i and j: by changing the wall, or by fixing particles. */
static inline int dem__is_taken_away(const dem_world *w, ptrdiff_t i, ptrdiff_t j) {
    if (j < 0) return !dem__is_at_wall(w, i, -1 - (int)j) || dem__is_fixed(w, i);
    return dem__is_fixed(w, i) && dem__is_fixed(w, j);
}

/* Books the work of moving fixed particles on others [J]. */
DEM_INLINE void dem__book_work_of_fixed(dem_world *w, double work) { w->engine->ledger.sums.external_work += work; }

/* Books the energy that the contact in slot c stores at its end: as removed if the caller or an exit ended it;
   otherwise as sliding loss, because its tangential spring is released. */
static inline void dem__book_contact_end(dem_world *w, ptrdiff_t c) {
    const int32_t i = w->engine->contacts.i[c], j = w->engine->contacts.j[c];
    dem_energy_ledger *sums = &w->engine->ledger.sums;
    if (!w->engine->ledger.counts) return;
    if (w->alive[i] <= 0 || (j >= 0 && w->alive[j] <= 0) || dem__is_taken_away(w, i, j))
        sums->removed += w->engine->contacts.elastic[c];
    else sums->sliding_loss += w->engine->contacts.elastic[c];
}

/* Returns the energy stored in all contacts [J]; 0 while no ledger is kept. */
static inline double dem__stored_energy(const dem_world *w) {
    double sum = 0.0;
    if (!w->engine->ledger.counts) return sum;
    DEM__EACH_CONTACT(w, c) { sum += w->engine->contacts.elastic[c]; }
    return sum;
}

/* Books the change of stored energy by the caller between runs: new contacts, changed constants. before: that energy at
   the end of the last run [J]. */
static inline void dem__book_callers_contacts(dem_world *w, double before) {
    if (w->engine->ledger.started) w->engine->ledger.sums.added += dem__stored_energy(w) - before;
}

/* Books the work of fixed particle i by its motion in a step, by the trapezoidal rule. */
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
