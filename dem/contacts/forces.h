/* Forces of all contacts, on one thread or several. Reads contacts; writes the sums of bodies and the forces on walls.
   Promises: every sum is added in the order of slots, whatever the number of threads. */
#pragma once
#include "kernel.h"

/* An evaluation of all contacts on several threads. */
typedef struct dem__evaluation {
    dem_world *w;
    dem_loop_fn loop;
    int has_friction;
} dem__evaluation;

/* Adds the postponed forces on the particles of shares first .. end-1 to their sums. They come from later shares, in
   their order. */
static inline void dem__add_postponed_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__postponed *all = w->engine->contacts.postponed;
    const int has_friction = ((const dem__evaluation *)context)->has_friction, shares = w->engine->contacts.shares;
    (void)part;
    for (int to = (int)first; to < (int)end; to++) {
        for (int from = to + 1; from < shares; from++) {
            for (int32_t at = dem__work_of(w, from)->head[to]; at >= 0;) {
                const dem__postponed *later = &all[at >> 1];
                const int side = at & 1;
                const double *turn = later->out + (side ? 6 : 3);
                double *sum = w->engine->bodies.sum[side ? later->j : later->i].load;
                at = side ? later->next_j : later->next_i;
                if (at >= 0) DEM__PREFETCH(&all[at >> 1]);
                for (int a = 0; a < 3; a++) sum[a] = side ? sum[a] - later->out[a] : sum[a] + later->out[a];
                for (int a = 0; a < 3 && has_friction; a++) sum[3 + a] += turn[a];
            }
        }
    }
}
static inline void dem__add_postponed(dem_world *w, dem__evaluation *e) {
    const dem__contacts *contacts = &w->engine->contacts;
    ptrdiff_t n = 0;
    for (int q = 0; q < contacts->chunk_count; q++) n += contacts->chunk[q].postponed;
    dem__in_parts(w, dem__parts_of(w, n / 2, contacts->shares), contacts->shares, dem__add_postponed_range, e);
}

/* Evaluates the chunks of a share. Its thread may add forces to particles whose contacts are all in this share or in
   later ones. It postpones the forces on others. The first chunks have the contacts of the last particles, so the last
   share comes first: a thread gets the contacts of the particles that it moves, which lie in its cache. */
static inline void dem__evaluate_share(void *context, int index) {
    const dem__evaluation *e = (const dem__evaluation *)context;
    const dem__contacts *contacts = &e->w->engine->contacts;
    const int shares = contacts->shares, share = shares - 1 - index;
    e->loop(e->w, dem__part(contacts->chunk_count, share, shares), dem__part(contacts->chunk_count, share + 1, shares),
            share);
}

/* Divides the chunks among threads. */
static inline void dem__make_shares(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    const int chunks = contacts->chunk_count,
              most = chunks < w->engine->scratch.works ? chunks : w->engine->scratch.works;
    contacts->shares = contacts->postponed ? dem__parts_of(w, contacts->count, most) : 1;
    for (int k = 0; k < contacts->shares; k++)
        contacts->share_from[k] = contacts->chunk[dem__part(chunks, k + 1, contacts->shares) - 1].first_rank;
}

/* Computes what the present contacts store and dissipate, for a ledger that begins. */
static inline void dem__find_stored(dem_world *w, dem_loop_fn loop) {
    dem__run *run = &w->engine->run;
    run->kernel_dt = 0.0;
    run->only_ledger = 1;
    w->engine->contacts.shares = 1;
    loop(w, 0, w->engine->contacts.chunk_count, 0);
    run->only_ledger = 0;
}

/* Computes the forces of all contacts and their sums. keep: keeps the force and torque of each for readers. */
static inline void dem__evaluate(dem_world *w, dem_loop_fn loop, double h, int has_friction, int keep) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__evaluation e;
    e.w = w, e.loop = loop, e.has_friction = has_friction;
    dem__make_shares(w);
    w->engine->run.kernel_dt = h;
    w->engine->run.keeps_wrenches = keep;
    dem__parallel(w, contacts->shares, dem__evaluate_share, &e);
    if (contacts->shares > 1) dem__add_postponed(w, &e);
    for (int k = 0; k < w->walls; k++) {
        dem_wall *wall = &w->wall[k];
        double belt_power = 0.0;
        wall->force = wall->torque = dem_vec3(0.0, 0.0, 0.0);
        for (int q = 0; q < contacts->chunk_count; q++) {
            if (!contacts->chunk[q].at_walls) continue;
            const dem__wall_force *push = &contacts->wall_force[q * w->engine->walls.capacity + k];
            wall->force = dem__add(wall->force, push->force);
            wall->torque = dem__add(wall->torque, push->torque);
            belt_power += push->belt_power;
        }
        dem__book_push(wall, h, wall->force, wall->torque, belt_power);
    }
}
