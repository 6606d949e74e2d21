/* All postings to the energy ledger. Reads contacts and bodies; writes the ledger. Promises: nothing else adds to its
   sums, but step/step.h sets where they start. */
#pragma once
#include "../base/arrays.h"

/* Books the potential energy that a particle gains when it wraps around the periodic box [J]. */
DEM_INLINE void dem__book_wrap(dem_world *w, double raised) {
    if (w->engine->ledger.on) w->engine->ledger.sums.added += raised, w->engine->ledger.sums.added_potential += raised;
}

/* Books the potential energy of a particle that is added at rest [J]. */
DEM_INLINE void dem__book_added(dem_world *w, double potential) { dem__book_wrap(w, potential); }

/* Books the potential energy that a particle gains when the caller changes gravity [J]. */
DEM_INLINE void dem__book_gravity(dem_world *w, double raised) { dem__book_wrap(w, raised); }

/* Books a change of a particle's kinetic energy by the caller [J]. */
DEM_INLINE void dem__book_motion(dem_world *w, double change) {
    if (w->engine->ledger.on) w->engine->ledger.sums.added += change;
}

/* Books the energy of a particle that is removed, and the potential part of it [J]. */
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

/* Books the work that moving fixed particles do on others [J]. */
DEM_INLINE void dem__book_work_of_fixed(dem_world *w, double work) {
    if (w->engine->ledger.counts) w->engine->ledger.sums.external_work += work;
}
