/* The work of links on particles, which the energy ledger books. Their forces are constant between two evaluations. */
#pragma once
#include "../particles/particles.h"

/* Returns the number of steps between two evaluations of the links, also for a loaded world without their law. */
DEM_INLINE int dem__steps_of_links(const dem_world *w) {
    const double n = floor(w->engine->links.interval / w->engine->run.dt);
    return n < 1.0 ? 1 : n > 1000.0 ? 1000 : (int)n;
}

/* Returns the time since links were evaluated [s]. */
DEM_INLINE double dem__since_evaluated(const dem_world *w) {
    return w->engine->run.dt * (double)(w->step - w->engine->links.evaluated_step);
}

/* Returns the work of the link forces on particle i, which is at x and has a spin, since the last evaluation [J]. */
DEM_INLINE double dem__link_work_until(const dem_world *w, ptrdiff_t i, dem_vec x, dem_vec spin) {
    const dem__bodies *bodies = &w->engine->bodies;
    const dem__links *links = &w->engine->links;
    const double turned = 0.5 * dem__since_evaluated(w);
    const dem_vec way = dem__nearest_image(w, dem__sub(x, dem__first(links->evaluated_at[i])));
    const dem_vec force = dem__sub(dem__first(bodies->load[i]), dem__first(bodies->external[i]));
    const dem_vec torque = dem__sub(dem__second(bodies->load[i]), dem__second(bodies->external[i]));
    return dem__dot(force, way) + turned * dem__dot(torque, dem__add(spin, dem__second(links->evaluated_at[i])));
}
static inline double dem__link_work(const dem_world *w, ptrdiff_t i) {
    const double tau = dem__now(w, i);
    if (!w->engine->links.is_loaded[i] || dem__is_fixed(w, i)) return 0.0;
    return dem__link_work_until(w, i, dem__at(w, i, tau), dem__spin_at(w, i, tau));
}

/* Stop and resume counting the work of links on some particles, while a caller changes how they move. Counting resumes
   from the spin that a particle would have had at the last evaluation. */
static inline void dem__stop_link_work(dem_world *w, dem__pieces of) {
    for (ptrdiff_t k = of.first; k < of.end && w->engine->ledger.on; k++) dem__book_link_work(w, dem__link_work(w, k));
}
static inline void dem__resume_link_work(dem_world *w, dem__pieces of) {
    for (ptrdiff_t k = of.first; k < of.end && w->engine->ledger.on; k++) {
        double *from = w->engine->links.evaluated_at[k];
        const double tau = dem__now(w, k);
        if (!w->engine->links.is_loaded[k]) continue;
        const dem_vec x = dem__at(w, k, tau),
                      spin = dem__plus(dem__spin_at(w, k, tau), -dem__since_evaluated(w), w->spin_rate[k]);
        for (int a = 0; a < 3; a++) from[a] = dem_axis(x, a), from[3 + a] = dem_axis(spin, a);
        dem__book_link_work(w, -dem__link_work(w, k));
    }
}

/* Sets the number of steps between two evaluations of the links, and from it the step of the last evaluation. */
static inline void dem__set_link_steps(dem_world *w) {
    dem__links *links = &w->engine->links;
    if (!links->on) return;
    if (links->law) links->every = dem__steps_of_links(w);
    links->evaluated_step = w->step - w->step % dem__steps_of_links(w);
}
