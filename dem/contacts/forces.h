/* Forces of all contacts, on one thread or several. Reads contacts; writes the sums of bodies and the forces on walls.
   Promises: every sum is added in the order of slots, whatever the number of threads. */
#pragma once
#include "kernel.h"

/* An evaluation of all contacts on several threads. */
typedef struct dem__evaluation {
    dem_loop_fn loop;
    int parts, has_friction;
} dem__evaluation;

/* Adds the postponed forces on particles low .. high-1 to their sums. */
static inline void dem__add_postponed_to(dem_world *w, int32_t low, int32_t high, int has_friction) {
    const dem__contacts *contacts = &w->engine->contacts;
    for (const dem__chunk *in = contacts->chunk; in < contacts->chunk + contacts->chunk_count; in++) {
        dem__postponed *later = contacts->postponed + in->first;
        if (in->postponed == 0 || in->low >= high || in->high < low) continue;
        for (ptrdiff_t k = 0; k < in->postponed; k++, later++) {
            const int32_t from = low > in->postpone_from ? low : in->postpone_from; /* the others have been added */
            const int to_i = later->i >= from && later->i < high, to_j = later->j >= from && later->j < high;
            double *out[9];
            for (int a = 0; a < 9; a++) out[a] = &later->out[a];
            dem__add_forces(w, 0, later->i, later->j, out, 0, has_friction, to_i, to_j);
        }
    }
}

/* Adds the postponed forces on the particles of the share before this thread's own (the first thread: of the last
   share): it made nearly all of them itself, so they are in its cache. */
static inline void dem__add_postponed_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__evaluation *e = (const dem__evaluation *)context;
    const dem__chunk *chunk = w->engine->contacts.chunk;
    const int chunks = w->engine->contacts.chunk_count, share = (part + e->parts - 1) % e->parts;
    first = dem__part(chunks, share, e->parts), end = dem__part(chunks, share + 1, e->parts);
    dem__add_postponed_to(w, chunk[end - 1].first_particle, first > 0 ? chunk[first - 1].first_particle : INT32_MAX,
                          e->has_friction);
}
static inline void dem__add_postponed(dem_world *w, int has_friction) {
    const dem__contacts *contacts = &w->engine->contacts;
    dem__evaluation e;
    ptrdiff_t n = 0;
    for (int q = 0; q < contacts->chunk_count; q++) n += contacts->chunk[q].postponed;
    e.parts = dem__parts_of(w, n, contacts->chunk_count), e.has_friction = has_friction;
    if (e.parts == 1) dem__add_postponed_to(w, 0, INT32_MAX, has_friction);
    else dem__in_parts(w, e.parts, contacts->chunk_count, dem__add_postponed_range, &e);
}

/* Evaluates the chunks of a share. Its thread may add to particles whose contacts are all in this share or in later
   ones; the forces on others are postponed. */
static inline void dem__evaluate_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__evaluation *e = (const dem__evaluation *)context;
    dem__chunk *chunk = w->engine->contacts.chunk;
    for (ptrdiff_t q = first; q < end; q++)
        chunk[q].postpone_from = first > 0 ? chunk[first - 1].first_particle : INT32_MAX;
    e->loop(w, first, end, part);
}

/* Computes what the contacts present store and dissipate now, for a ledger that begins. */
static inline void dem__find_stored(dem_world *w, dem_loop_fn loop) {
    dem__run *run = &w->engine->run;
    run->kernel_dt = 0.0;
    run->only_ledger = 1;
    loop(w, 0, w->engine->contacts.chunk_count, 0);
    run->only_ledger = 0;
}

/* Computes the forces of all contacts and their sums. keep: keeps the wrench of each for readers. */
static inline void dem__evaluate(dem_world *w, dem_loop_fn loop, double h, int has_friction, int keep) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__evaluation e;
    e.loop = loop, e.has_friction = has_friction;
    e.parts = contacts->postponed
                  ? dem__parts_of(w, contacts->count,
                                  contacts->chunk_count < w->engine->scratch.works ? contacts->chunk_count
                                                                                   : w->engine->scratch.works)
                  : 1;
    w->engine->run.kernel_dt = h;
    w->engine->run.keeps_wrenches = keep;
    dem__in_parts(w, e.parts, contacts->chunk_count, dem__evaluate_range, &e);
    if (e.parts > 1) dem__add_postponed(w, has_friction);
    for (int k = 0; k < w->walls; k++) {
        dem_wall *wall = &w->wall[k];
        double belt_power = 0.0;
        wall->force = wall->torque = dem_vec3(0.0, 0.0, 0.0);
        for (int q = 0; q < contacts->chunk_count; q++) {
            const dem__wall_force *push = &contacts->wall_force[q * w->engine->walls.capacity + k];
            wall->force = dem__add(wall->force, push->force);
            wall->torque = dem__add(wall->torque, push->torque);
            belt_power += push->belt_power;
        }
        dem__book_push(wall, h, wall->force, wall->torque, belt_power);
    }
}
