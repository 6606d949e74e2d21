/* Records of particles that pass exits. Reads bodies; writes the records, and marks particles that leave. Promises: the
   order of records does not depend on the order of tests. */
#pragma once
#include "../motion/state.h"

/* Records a particle, or its rigid body, that passes an exit in this step, and marks it for removal at the end of the
   step. */
static inline void dem__pass_exit(dem_world *w, ptrdiff_t i, int wall) {
    dem__run *run = &w->engine->run;
    dem__bodies *bodies = &w->engine->bodies;
    double tau = (double)(w->step + 1 - w->particle[i].origin) * run->dt;
    const dem__pieces own = dem__pieces_of(w, i);
    i = own.first;
    if (w->alive[i] < 0) { /* it passed another exit in this step: the smaller index counts, whatever the order of
                              tests */
        ptrdiff_t k = w->passed_count - 1;
        while (w->passed[k].id != w->id[i]) k--;
        if (wall < w->passed[k].exit) w->passed[k].exit = wall;
        return;
    }
    if (w->passed_count >= bodies->passed_capacity) {
        ptrdiff_t larger = bodies->passed_capacity * 2 + 256;
        dem_passed *fresh = (dem_passed *)w->def.allocator.fn(w->def.allocator.user, w->passed,
                                                              (size_t)bodies->passed_capacity * sizeof *fresh,
                                                              (size_t)larger * sizeof *fresh);
        if (!fresh) {
            w->status = DEM_OUT_OF_MEMORY;
            return;
        }
        w->passed = fresh;
        bodies->passed_capacity = larger;
    }
    /* sorted by id, whatever the order of tests in this step */
    double time = run->start_time + (double)(w->step + 1 - run->start_step) * run->dt;
    ptrdiff_t at = w->passed_count++;
    w->passed_total++;
    for (; at > 0 && w->passed[at - 1].time == time && w->passed[at - 1].id > w->id[i]; at--)
        w->passed[at] = w->passed[at - 1];
    dem_passed *p = &w->passed[at];
    p->time = time;
    p->diameter = dem__diameter_of(w, i);
    p->position = dem__in_box(w, dem__centre_at(w, i, tau));
    p->velocity = dem__true_drift_at(w, i, tau);
    p->id = w->id[i];
    p->group = w->group[i];
    p->exit = wall;
    for (ptrdiff_t k = own.first; k < own.end; k++) w->alive[k] = DEM_LEAVING; /* removed at the end of the step */
    run->leaving = 1;
}
