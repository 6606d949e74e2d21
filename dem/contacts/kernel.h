/* Forces of contacts and links, block by block: rows, law, partial steps, sums. Reads bodies, walls, contacts,
   links; writes contacts, the sums of bodies and the forces on walls. Promises: the same bits for any division among
   threads. */
#pragma once
#include "first_and_last_step.h"

/* The working memory of a thread for a block. It lies in the engine, because a stack may be small (64 kB in
   WebAssembly). */
struct dem__work {
    dem__rows rows;
    dem__type_rows types;
    dem__block_rows block;
    dem__row before, was, ended,
        past[DEM_STATE_MAX]; /* of the step before: force, gap, whether the contact ended; history at the start */
    dem__wall_row wall[DEM__BLOCK];
    int walls;
    dem__timer_batch batch;                       /* for tests of pairs */
    int32_t head[DEM__CHUNKS], tail[DEM__CHUNKS]; /* lists of postponed forces for each share: see dem__postponed */
};

/* Returns the working memory of a thread. It begins with a cache line. Otherwise every second vector of a row would lie
   in two lines, which costs 4 % of the time of a bed. */
enum { DEM__WORK_BYTES = (int)((sizeof(dem__work) + 63) / 64 * 64) };
DEM_INLINE dem__work *dem__work_of(const dem_world *w, int part) {
    return (dem__work *)(void *)(w->engine->scratch.work + (size_t)part * DEM__WORK_BYTES);
}

/* Allocates the working memory of the threads of a run. Returns 0 when out of memory. */
static inline int dem__make_work(dem_world *w) {
    dem__scratch *scratch = &w->engine->scratch;
    const dem_allocator *a = &w->def.allocator;
    const int usable = dem__usable_threads(w), wanted = usable < DEM__CHUNKS ? usable : DEM__CHUNKS;
    const size_t bytes = (size_t)wanted * DEM__WORK_BYTES + 64;
    scratch->threads = usable;
    if (wanted <= scratch->works) return 1;
    char *block = (char *)a->fn(a->user, NULL, 0, bytes);
    if (!block) return 0;
    dem__release(a, scratch->work_block, scratch->work_bytes);
    scratch->work_block = block, scratch->work_bytes = bytes;
    scratch->work = block + 64 - (size_t)((uintptr_t)block & 63);
    scratch->works = wanted;
    return 1;
}

typedef void dem__partial_step_fn(dem_world *w, ptrdiff_t c, dem_contact *q, const dem__partial_step *was);

/* Returns whether a contact began or ended in this step, from its forces and the gap before. It works on bits, because
   branches would keep the loop scalar. */
DEM_INLINE int64_t dem__began_or_ended(double before, double now, double gap_before) {
    const int64_t idle = before == 0.0;
    return (idle ^ (int64_t)(now == 0.0)) & ((idle ^ 1) | (int64_t)(gap_before > 0.0));
}

/* Marks and lists the contacts that began or ended, or that their law has ended, in the block from slot base on.
   Returns how many. */
DEM_INLINE ptrdiff_t dem__mark_edges(dem_world *w, dem__chunk *in, ptrdiff_t base, int n, const double *before,
                                     const double *was, const double *ended, const double *force) {
    dem__contacts *contacts = &w->engine->contacts;
    const ptrdiff_t marked = in->marked;
    int64_t mark[DEM__BLOCK], any = 0;
    for (int k = 0; k < n; k++) {
        mark[k] = dem__began_or_ended(before[k], force[k], was[k]) | (int64_t)(ended[k] != 0.0) << 1;
        any |= mark[k];
    }
    for (int k = 0; k < n && any; k++) {
        if (!mark[k]) continue;
        contacts->partial[base + k] = (uint8_t)(mark[k] & 1);
        contacts->ended[base + k] = (uint8_t)(mark[k] >> 1);
        contacts->slots[in->first + in->marked++] = (int32_t)(base + k);
    }
    return in->marked - marked;
}

/* Adds the force on i and the torques on i and j of a contact in chunk q, which are in out[][k], to the sum of i and to
   that of j or of a wall. */
DEM_INLINE void dem__add_forces(dem_world *w, ptrdiff_t q, int32_t i, int32_t j, double *const *out, ptrdiff_t k,
                                int has_friction, int to_i, int to_j) {
    const double fx = out[0][k], fy = out[1][k], fz = out[2][k];
    double turn_i[3], turn_j[3]; /* all sums are read before they are written, so that they are added as vectors */
    for (int a = 0; a < 3; a++)
        turn_i[a] = has_friction ? out[3 + a][k] : 0.0, turn_j[a] = has_friction ? out[6 + a][k] : 0.0;
    if (to_i) {
        double *sum = w->engine->bodies.sum[i].load;
        sum[0] += fx, sum[1] += fy, sum[2] += fz;
        if (has_friction) sum[3] += turn_i[0], sum[4] += turn_i[1], sum[5] += turn_i[2];
    }
    if (!to_j) return;
    if (j >= 0) {
        double *sum = w->engine->bodies.sum[j].load;
        sum[0] -= fx, sum[1] -= fy, sum[2] -= fz;
        if (has_friction) sum[3] += turn_j[0], sum[4] += turn_j[1], sum[5] += turn_j[2];
        return;
    }
    w->engine->contacts.chunk[q].at_walls = 1;
    dem__wall_force *push = &w->engine->contacts.wall_force[q * w->engine->walls.capacity - 1 - j];
    const dem_vec f = dem_vec3(-fx, -fy, -fz), arm = dem__sub(w->particle[i].x, w->wall[-1 - j].position);
    push->force = dem__add(push->force, f);
    push->torque = dem__add(push->torque, dem__sub(dem__cross(arm, f), dem__first(turn_i)));
}

/* Returns the share to which the particle of a rank belongs. */
DEM_INLINE int dem__owner_of(const dem__contacts *contacts, int32_t rank) {
    int low = 0, high = contacts->shares - 1;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (contacts->share_from[middle] <= rank) high = middle;
        else low = middle + 1;
    }
    return low;
}

/* Appends one side of a postponed force to the list of the share to which its particle belongs. */
DEM_INLINE void dem__postpone(dem_world *w, dem__work *x, int32_t entry, int side, int32_t rank) {
    dem__postponed *all = w->engine->contacts.postponed;
    const int share = dem__owner_of(&w->engine->contacts, rank);
    const int32_t last = x->tail[share], own = 2 * entry + side;
    if (last < 0) x->head[share] = own;
    else if (last & 1) all[last >> 1].next_j = own;
    else all[last >> 1].next_i = own;
    x->tail[share] = own;
    if (side) all[entry].next_j = -1;
    else all[entry].next_i = -1;
}

/* Adds the forces of n contacts of chunk q slot by slot, which fixes the order of sums. postpone_from: INT32_MAX, or
   the rank from which on particles belong to earlier shares, whose threads must add first. Forces on these are
   postponed for dem__add_postponed. */
DEM_INLINE void dem__gather_forces(dem_world *w, dem__work *x, ptrdiff_t q, ptrdiff_t base, int n, double *const *out,
                                   int has_friction, int32_t postpone_from) {
    dem__contacts *contacts = &w->engine->contacts;
    const int32_t *rank = w->engine->bodies.rank;
    dem__chunk *in = &contacts->chunk[q];
    if (postpone_from == INT32_MAX) {
        for (int k = 0; k < n; k++)
            dem__add_forces(w, q, contacts->i[base + k], contacts->j[base + k], out, k, has_friction, 1, 1);
        return;
    }
    for (int k = 0; k < n; k++) {
        const int32_t i = contacts->i[base + k], j = contacts->j[base + k], rank_i = rank[i],
                      rank_j = j < 0 ? -1 : rank[j];
        dem__add_forces(w, q, i, j, out, k, has_friction, rank_i < postpone_from, rank_j < postpone_from);
        if (rank_i < postpone_from && rank_j < postpone_from) continue;
        const ptrdiff_t entry = in->first + in->postponed++;
        dem__postponed *later = &contacts->postponed[entry];
        for (int a = 0; a < (has_friction ? 9 : 3); a++) later->out[a] = out[a][k];
        later->i = i, later->j = j;
        if (rank_i >= postpone_from) dem__postpone(w, x, (int32_t)entry, 0, rank_i);
        if (rank_j >= postpone_from) dem__postpone(w, x, (int32_t)entry, 1, rank_j);
    }
}

/* Prefetches a particle of a link or a contact. For a wall (j < 0) any particle will do. */
DEM_INLINE void dem__prefetch_particle(const dem_world *w, ptrdiff_t j) {
    const dem_particle *p = &w->particle[j < 0 ? 0 : j];
    DEM__PREFETCH(&p->x);
    DEM__PREFETCH(&p->a);
}
/* Prefetches what the kernel reads and adds up of body j. For a wall (j < 0) the address lies one before the arrays: a
   prefetch cannot fail. */
DEM_INLINE void dem__prefetch_body(const dem_particle *particle, const dem__sum *sum, ptrdiff_t j) {
    const uintptr_t p = (uintptr_t)particle + (uintptr_t)j * sizeof *particle;
    DEM__PREFETCH((const void *)p);
    DEM__PREFETCH((const void *)(p + offsetof(dem_particle, a)));
    DEM__PREFETCH((const void *)((uintptr_t)sum + (uintptr_t)j * sizeof *sum));
}

/* These call the functions for polyhedra on a block. They stand apart because a call through a pointer would slow the
   kernel down. */
static DEM__NOINLINE void dem__fill_other_rows(const dem__convex_calls *other, const dem_world *w, dem__work *x,
                                               ptrdiff_t base, int n, double half) {
    other->fill_rows(w, &x->rows, &x->types, base, n, half, x->wall);
}
static DEM__NOINLINE void dem__finish_other_rows(const dem__convex_calls *other, const dem_world *w, dem__work *x,
                                                 ptrdiff_t base, int n, const dem__columns *at, double half,
                                                 int features) {
    other->finish_rows(w, &x->rows, &x->types, base, n, at, x->before, half, features);
}
static DEM__NOINLINE void dem__exclude_other(const dem__convex_calls *other, dem_world *w, const dem__chunk *in,
                                             ptrdiff_t marked) {
    other->leave_edges(w, in, marked);
}

/* Gathers the block of n contacts from slot base on, and prefetches the next block, of this chunk or of the one after
   it. */
DEM_INLINE void dem__gather_block(const dem_world *w, dem__work *x, ptrdiff_t chunk, ptrdiff_t base, int n,
                                  const dem_law *law, double half, int has_friction) {
    const dem__contacts *contacts = &w->engine->contacts;
    const dem__chunk *in = &contacts->chunk[chunk];
    const dem__chunk *then =
        base + DEM__BLOCK < in->first + in->count || chunk + 1 == contacts->chunk_count ? in : in + 1;
    const ptrdiff_t ahead = then == in ? base + DEM__BLOCK : then->first, stop = then->first + then->count;
    const dem_particle *particle = w->particle;
    const dem__sum *sum = w->engine->bodies.sum;
    const int32_t *of_i = contacts->i, *of_j = contacts->j;
    int walls = 0;
    for (int k = 0; k < n; k++) {
        const ptrdiff_t c = base + k, i = of_i[c], j = of_j[c];
        if (ahead + k < stop)
            dem__prefetch_body(particle, sum, of_i[ahead + k]), dem__prefetch_body(particle, sum, of_j[ahead + k]);
        if (j >= 0) dem__gather_pair(particle, i, j, &x->rows, k, has_friction);
        else dem__gather_wall(w, i, -1 - j, contacts->element[c], c, &x->rows, k, half, &x->wall[walls++]);
    }
    for (int k = n; k < DEM__BLOCK && ahead + k < stop; k++) {
        dem__prefetch_body(particle, sum, of_i[ahead + k]), dem__prefetch_body(particle, sum, of_j[ahead + k]);
    }
    x->walls = walls;
    dem__load_types(w, base, n, law->constants, &x->types);
    dem__complete_rows(w, &x->rows, &x->types, n, half, half, x->wall, walls, has_friction);
}

/* Calls the law for n contacts of a block, or for n links, and stores its results. Links use only the sizes of a
   contact type. Conditions on features are constants where the loop is compiled. */
#define DEM__OF_LINKS (1 << 20) /* no enum: C++20 warns where numbers of two enums are combined */
DEM_INLINE void dem__apply_law(const dem_world *w, dem__work *x, const int32_t *i, const int32_t *j, int n,
                               const dem__columns *old, const dem__columns *at, const dem_law *law, double h,
                               double rate, int features) {
    const void *user = w->user;
    const int has_friction = (features & DEM_FRICTION) != 0, is_link = (features & DEM__OF_LINKS) != 0;
    dem__row share; /* a loop of its own, which compilers leave out if the law does not use it */
    for (int k = 0; k < n; k++) share[k] = dem__mass_share(w, i[k], j[k]);
    DEM__INDEPENDENT
    for (int k = 0; k < n; k++) {
        dem_contact q;
        dem_response r;
        double s[DEM_STATE_MAX], p[DEM_CONSTANTS_MAX], arm_i = 0.0, arm_j = 0.0;
        memset(&r, 0, sizeof r); /* quantities that a law does not set are 0 */
        for (int a = 0; a < law->constants && !is_link; a++) p[a] = x->types.constant[a][k];
        for (int a = 0; a < law->states; a++) s[a] = old->state[a][k];
        if (law->vectors > 0)
            dem__turn(&x->rows, k, h, s); /* a function: clang does not unroll so long a loop, even for one turn */
        for (int a = 1; a < law->vectors; a++) dem__turn(&x->rows, k, h, s + 3 * a);
        for (int a = 0; a < law->history && has_friction && !is_link; a++) x->past[a][k] = s[a];
        dem__contact_geometry(&x->rows, &x->types, k, is_link ? 0.0 : 0.5 * h, is_link ? 0.0 : 1.0, has_friction, &q,
                              &arm_i, &arm_j);
        const double predict =
            is_link ? 1.0 : x->types.predict[k]; /* read outside the condition, or the loop would not be vectorised */
        q.closing *= x->rows.gap[k] < 0.0 ? predict : 1.0;
        q.mass = is_link ? 0.0 : x->types.mass[k];
        q.share = share[k];
        q.dt = h;
        q.rate = rate;
        q.constants = is_link ? NULL : p;
        q.user = user;
        law->force(&q, s, &r);
        for (int a = 0; a < law->history; a++) at->state[a][k] = dem__flushed(s[a]);
        x->ended[k] = r.ended;
        if (!is_link) {
            x->before[k] = old->force[k], x->was[k] = old->gap[k];
            at->force[k] = r.contact;
            at->gap[k] = x->rows.gap[k];
        }
        dem__put_force(at->out, k, &q, &r, arm_i, arm_j, features);
        if (features & DEM_ENERGY) {
            /* the mean along a step has k/24 less, and predict is 1 - 11 k/24 */
            r.normal_power *= 1.0 - (1.0 - predict) / 11.0;
            dem__put_losses(at, old, k, &r, h, x->before[k]);
        }
    }
}

/* Computes the work of walls on their contacts from powers, by the trapezoidal rule. A wall that turns works also
   against rolling resistance: its force counts at the centre of the particle, with the torque about it. */
DEM_INLINE void dem__put_wall_work(const dem__work *x, int n, const dem__columns *old, const dem__columns *at,
                                   double half, int rolling) {
    for (int k = 0; k < n; k++) at->loss[3][k] = 0.0, at->power[2][k] = old->power[2][k];
    for (int q = 0; q < x->walls; q++) {
        const int k = x->wall[q].row;
        const dem_wall *wall = x->wall[q].wall;
        const dem_vec normal = dem_vec3(x->rows.nx[k], x->rows.ny[k], x->rows.nz[k]);
        const int turns = rolling && wall->spin != 0.0;
        const dem_vec v = turns ? dem__surface_velocity(wall, x->wall[q].particle->x, normal) : x->wall[q].velocity;
        double power = at->out[0][k] * v.x + at->out[1][k] * v.y + at->out[2][k] * v.z;
        for (int a = 0; a < 3 && turns; a++) power += at->out[3 + a][k] * wall->spin * dem_axis(wall->spin_axis, a);
        at->loss[3][k] = half * (old->power[2][k] + power);
        at->power[2][k] = power;
    }
}

/* Corrects the partial steps of a block: those of the last `marked` contacts in its chunk's list. */
DEM_INLINE void dem__correct_partial_steps(dem_world *w, dem__work *x, const dem__chunk *in, ptrdiff_t base,
                                           ptrdiff_t marked, const dem__columns *old, const dem__columns *at,
                                           const dem_law *law, dem__partial_step_fn *correct, int features) {
    const dem__run *run = &w->engine->run;
    const dem__contacts *contacts = &w->engine->contacts;
    const int has_friction = (features & DEM_FRICTION) != 0;
    for (ptrdiff_t m = in->marked - marked, q = 0; m < in->marked; m++) {
        const ptrdiff_t c = contacts->slots[in->first + m];
        const int k = (int)(c - base);
        dem_contact view;
        dem__partial_step partial;
        double p[DEM_CONSTANTS_MAX];
        if (!contacts->partial[c]) continue;
        while (q < x->walls && x->wall[q].row < k) q++;
        for (int a = 0; a < law->constants; a++) p[a] = x->types.constant[a][k];
        dem__contact_geometry(&x->rows, &x->types, k, 0.5 * run->kernel_dt, 1.0, has_friction, &view, &partial.arm_i,
                              &partial.arm_j);
        view.mass = x->types.mass[k];
        view.share =
            dem__mass_share(w, contacts->i[c], contacts->j[c]); /* not from the row, which a law need not compute */
        view.dt = 0.0;
        view.rate = 1.0 / run->dt;
        view.constants = p;
        view.user = w->user;
        partial.gap = x->was[k], partial.force = x->before[k];
        for (int a = 0; a < law->states && has_friction; a++)
            partial.state[a] = a < law->history ? x->past[a][k] : old->state[a][k];
        for (int a = 0; a < 9; a++) partial.out[a] = at->out[a] + k;
        partial.wall_speed = contacts->j[c] < 0 ? x->wall[q].velocity : dem_vec3(0.0, 0.0, 0.0);
        correct(w, c, &view, &partial);
        for (int a = 0; a < (has_friction ? 9 : 3) && run->keeps_wrenches; a++) old->out[a][k] = at->out[a][k];
    }
}

/* Adds up the power of belts. The power of the rest of a wall's motion follows from the sums of its forces. */
static DEM__NOINLINE void dem__add_belts(dem_world *w, const dem__work *x, ptrdiff_t chunk, const double *fx,
                                         const double *fy, const double *fz) {
    for (int q = 0; q < x->walls; q++) {
        const dem_wall *wall = x->wall[q].wall;
        const int k = x->wall[q].row;
        if (!dem__is_belt(wall)) continue;
        const dem_vec along = dem__belt_velocity(wall, dem_vec3(x->rows.nx[k], x->rows.ny[k], x->rows.nz[k]));
        w->engine->contacts.wall_force[chunk * w->engine->walls.capacity + (wall - w->wall)].belt_power +=
            fx[k] * along.x + fy[k] * along.y + fz[k] * along.z;
    }
}

/* Evaluates the contacts of a chunk. A contact reads its own slot, particles and walls, which do not change meanwhile,
   and writes only its own slot. Therefore any division among threads gives the same bits. Each block is summed while it
   is in the cache. */
DEM_INLINE void dem__evaluate_chunk(dem_world *w, dem__work *x, ptrdiff_t chunk, const dem_law *law,
                                    dem__partial_step_fn *correct, int features, int32_t postpone_from) {
    const dem__run *run = &w->engine->run;
    const int has_friction = (features & DEM_FRICTION) != 0;
    const int only_ledger = (features & DEM_ENERGY) && run->only_ledger;
    const double h = run->kernel_dt, rate = 1.0 / run->dt;
    const dem__convex_calls *other = w->engine->convex.calls; /* for contacts of polyhedra; NULL if there are none */
    dem__chunk *in = &w->engine->contacts.chunk[chunk];
    for (ptrdiff_t base = in->first, end = in->first + in->count; base < end; base += DEM__BLOCK) {
        const int n = end - base < DEM__BLOCK ? (int)(end - base) : DEM__BLOCK;
        dem__columns old, at;
        dem__gather_block(w, x, chunk, base, n, law, 0.5 * h, has_friction);
        if (other) dem__fill_other_rows(other, w, x, base, n, 0.5 * h);
        dem__columns_of(w, base, law, features, &old);
        dem__new_columns(w, base, law, features, DEM__COPY_ROWS || only_ledger, &x->block, &at);
        dem__apply_law(w, x, w->engine->contacts.i + base, w->engine->contacts.j + base, n, &old, &at, law, h, rate,
                       features);
        if (other) {
            const dem__columns same = at; /* with the address of `at` itself, clang would not vectorise the law */
            dem__finish_other_rows(other, w, x, base, n, &same, 0.5 * h, features);
        }
        if (features & DEM_ENERGY)
            dem__put_wall_work(x, n, &old, &at, 0.5 * h, (w->engine->run.features & DEM_ROLLING) != 0);
        if (only_ledger) {
            dem__store_ledger(&old, &at, n);
            continue;
        }
        const ptrdiff_t marked = dem__mark_edges(w, in, base, n, x->before, x->was, x->ended, at.force);
        if (other) dem__exclude_other(other, w, in, marked);
        dem__store(&old, &at, n, law, features, run->keeps_wrenches);
        if (h > 0.0) dem__correct_partial_steps(w, x, in, base, marked, &old, &at, law, correct, features);
        dem__gather_forces(w, x, chunk, base, n, at.out, has_friction, postpone_from);
        if (x->walls > 0) dem__add_belts(w, x, chunk, at.out[0], at.out[1], at.out[2]);
    }
}

/* Evaluates the contacts of chunks first .. end-1 on one thread. */
DEM_INLINE void dem__kernel(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, const dem_law *law,
                            dem__partial_step_fn *correct, int features) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__work *work = dem__work_of(w, part);
    const int32_t postpone_from = part > 0 && contacts->shares > 1 ? contacts->share_from[part - 1] : INT32_MAX;
    for (int k = 0; k < DEM__BLOCK; k++) work->types.kind[k] = -2;
    for (int k = 0; k < contacts->shares; k++) work->head[k] = work->tail[k] = -1;
    for (ptrdiff_t q = first; q < end; q++) {
        contacts->chunk[q].marked = contacts->chunk[q].postponed = 0, contacts->chunk[q].at_walls = 0;
        for (ptrdiff_t k = 0; k < w->walls; k++) {
            dem__wall_force *push = &contacts->wall_force[q * w->engine->walls.capacity + k];
            push->force = push->torque = dem_vec3(0.0, 0.0, 0.0), push->belt_power = 0.0;
        }
        dem__evaluate_chunk(w, work, q, law, correct, features, postpone_from);
    }
}

#define DEM__LOOP(name, call)                                                                                          \
    DEM__AVX2_CLONE(name, (dem_world * world, ptrdiff_t first, ptrdiff_t end, int part), (world, first, end, part),    \
                    call)
#define DEM__KERNEL_LOOPS(name, law, features)                                                                         \
    DEM__FAST static DEM__NOINLINE void name##_edge(dem_world *world, ptrdiff_t c, dem_contact *q,                     \
                                                    const dem__partial_step *was) {                                    \
        dem__correct_partial_step(world, c, q, was, &(law), features);                                                 \
    }                                                                                                                  \
    DEM__LOOP(name##_loop, dem__kernel(world, first, end, part, &(law), name##_edge, features))
#define DEM__LEDGER_OF(features) ((features)&DEM_ENERGY ? dem__add_ledger : NULL)
#define DEM_KERNEL(name, law, features)                                                                                \
    DEM__KERNEL_LOOPS(name, law, features)                                                                             \
    static const dem_kernel name = {&(law), features, name##_loop, DEM__LEDGER_OF(features)};
/* A kernel that compilers leave out where nothing calls name(). gcc at -O0 keeps constants that nobody reads, and what
   they point to, but not those in an inline function. Tables of functions are written in the same way. */
#define DEM__KERNEL_OF(name, law, features)                                                                            \
    DEM__KERNEL_LOOPS(name, law, features)                                                                             \
    static inline const dem_kernel *name(void) {                                                                       \
        static const dem_kernel kernel = {&(law), features, name##_loop, DEM__LEDGER_OF(features)};                    \
        return &kernel;                                                                                                \
    }
