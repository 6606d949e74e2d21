/* One step of a pair over all rows: halos of periodic rows, collision, skipped slabs, detection of divergence. */
#pragma once
#include "kernels.h"

/* ==== >>collide ==== */

#define FILTRATION__KERNEL(name, real, row, forced)                                                                    \
    FILTRATION__CLONES(name, (real *const *p, const filtration__rates *rates, int n, ptrdiff_t ahead, int *bad),       \
                       (p, rates, n, ahead, bad), *bad = row(p, rates, n, ahead, forced))
FILTRATION__KERNEL(filtration__collide19d, double, filtration__row19d, 0)
FILTRATION__KERNEL(filtration__collide19d_forced, double, filtration__row19d, 1)
FILTRATION__KERNEL(filtration__collide19f, float, filtration__row19f, 0)
FILTRATION__KERNEL(filtration__collide19f_forced, float, filtration__row19f, 1)
FILTRATION__KERNEL(filtration__collide15d, double, filtration__row15d, 0)
FILTRATION__KERNEL(filtration__collide15d_forced, double, filtration__row15d, 1)

static inline int filtration__forced(const filtration__rates *r) {
    return r->force[0] != 0.0 || r->force[1] != 0.0 || r->force[2] != 0.0;
}

/* Collides the nodes of a row. p[i]: where direction i of node 0 is read. Returns whether a node is bad. */
static inline int filtration__collide_row(const filtration__lattice *l, const ptrdiff_t *place) {
    int bad = 0, forced = filtration__forced(&l->rates);
    if (l->single) {
        float *p[FILTRATION__Q];
        for (int i = 0; i < l->q; i++) p[i] = (float *)l->f + place[i];
        if (forced) filtration__collide19f_forced(p, &l->rates, l->nx, l->bundle, &bad);
        else filtration__collide19f(p, &l->rates, l->nx, l->bundle, &bad);
        return bad;
    }
    double *p[FILTRATION__Q];
    for (int i = 0; i < l->q; i++) p[i] = (double *)l->f + place[i];
    if (l->q == 15 && forced) filtration__collide15d_forced(p, &l->rates, l->nx, l->bundle, &bad);
    else if (l->q == 15) filtration__collide15d(p, &l->rates, l->nx, l->bundle, &bad);
    else if (forced) filtration__collide19d_forced(p, &l->rates, l->nx, l->bundle, &bad);
    else filtration__collide19d(p, &l->rates, l->nx, l->bundle, &bad);
    return bad;
}

/* Before an even step, moves the populations that left a periodic row from its halo to the nodes at the other end. */
static inline void filtration__fold(filtration__lattice *l, ptrdiff_t row) {
    for (int i = 1; i < l->q; i++) {
        int c = l->c[i][0];
        if (c > 0)
            filtration__put(l, filtration__place(l, row, i, 0),
                            filtration__get(l, filtration__place(l, row, i, l->nx)));
        if (c < 0)
            filtration__put(l, filtration__place(l, row, i, l->nx - 1),
                            filtration__get(l, filtration__place(l, row, i, -1)));
    }
}

/* After an even step, copies the ends of a periodic row to its halo, where the next odd step reads them. */
static inline void filtration__spread(filtration__lattice *l, ptrdiff_t row) {
    for (int i = 1; i < l->q; i++) {
        int c = l->c[i][0];
        if (c > 0)
            filtration__put(l, filtration__place(l, row, i, l->nx),
                            filtration__get(l, filtration__place(l, row, i, 0)));
        if (c < 0)
            filtration__put(l, filtration__place(l, row, i, -1),
                            filtration__get(l, filtration__place(l, row, i, l->nx - 1)));
    }
}

/* l->odd already belongs to the next step: this one is of the other kind. */
static inline void filtration__collide_at(filtration__lattice *l, int y, int z) {
    ptrdiff_t place[FILTRATION__Q], row = filtration__row(l, y, z);
    unsigned char *state = l->row_state + (ptrdiff_t)z * l->ny + y;
    if (!l->odd) {
        ptrdiff_t near[3][3];
        for (int b = -1; b <= 1; b++)
            for (int a = -1; a <= 1; a++) near[b + 1][a + 1] = filtration__row(l, y + a, z + b) * l->bundle;
        for (int i = 0; i < l->q; i++)
            place[i] =
                near[1 - l->c[i][2]][1 - l->c[i][1]] + filtration__opposite(i) * l->stride + l->lead - l->c[i][0];
    } else {
        for (int i = 0; i < l->q; i++) place[i] = filtration__place(l, row, i, 0);
        if (l->periodic_x) filtration__fold(l, row);
    }
    if (filtration__collide_row(l, place)) *state |= FILTRATION__ROW_BAD;
    if (l->odd && l->periodic_x) filtration__spread(l, row);
}

static inline void filtration__task_range(ptrdiff_t n, int task, ptrdiff_t *first, ptrdiff_t *end) {
    *first = n * task / FILTRATION__TASKS;
    *end = n * (task + 1) / FILTRATION__TASKS;
}

/* Wakes slabs at exact rest next to moving ones. An odd step reads the neighbouring slabs and writes to them, so that
   motion reaches two slabs farther. always: wakes all. */
static inline void filtration__wake(filtration__lattice *l, int always) {
    unsigned char *a = l->slab_active;
    int reach = l->odd ? 2 : 0;
    if (always) {
        memset(a, 1, (size_t)l->nz);
        return;
    }
    for (int pass = 0; pass < reach; pass++) {
        int wraps = !l->ghost_z && (a[0] || a[l->nz - 1]);
        for (int z = 0; z < l->nz; z++)
            if (a[z] == 1 && z + 1 < l->nz && !a[z + 1]) a[z + 1] = 2;
        for (int z = l->nz - 1; z >= 0; z--)
            if (a[z] == 1 && z > 0 && !a[z - 1]) a[z - 1] = 2;
        if (wraps) a[0] = a[l->nz - 1] = 1;
        for (int z = 0; z < l->nz; z++) a[z] = a[z] != 0;
    }
}

/* Returns whether a node lies in a film between surfaces: fewer than half of its neighbours within the box are fluid.
   The flow there is not resolved; lubrication replaces it. */
static inline int filtration__in_film(const filtration__lattice *l, int x, int y, int z) {
    int fluid = 0;
    for (int i = 1; i < l->q; i++) {
        int p[3] = {filtration__wrap(x + l->c[i][0], l->nx), filtration__wrap(y + l->c[i][1], l->ny),
                    filtration__wrap(z + l->c[i][2], l->nz)};
        fluid += l->owner[filtration__node(l, p[0], p[1], p[2])] == FILTRATION__FLUID;
    }
    return 2 * fluid < l->q;
}

/* Returns the density that a film has beside a sphere, or the mean where there is none. */
static inline double filtration__film_density(const filtration__lattice *l, int x, int y, int z) {
    for (int i = 1; i < l->q; i++) {
        const int32_t owner = l->owner[filtration__node(l, filtration__wrap(x + l->c[i][0], l->nx),
                                                        filtration__wrap(y + l->c[i][1], l->ny),
                                                        filtration__wrap(z + l->c[i][2], l->nz))];
        if (owner >= 0) return l->balls[owner].density;
    }
    return 0.0;
}

/* Finds the first node of a row that is too fast or not a number. Solids and films do not count; they are set to rest.
   Returns 0 if there is none. */
static inline int filtration__bad_node(filtration__lattice *l, int y, int z, filtration_problem *problem) {
    for (int x = 0; x < l->nx; x++) {
        double u[3] = {0, 0, 0}, r = 0.0;
        int fluid = l->owner[filtration__node(l, x, y, z)] == FILTRATION__FLUID;
        for (int i = 0; i < l->q; i++) {
            double h = filtration__get(l, filtration__outgoing(l, x, y, z, i));
            r += h;
            for (int a = 0; a < 3; a++) u[a] += l->c[i][a] * h;
        }
        for (int a = 0; a < 3; a++) u[a] -= 0.5 * l->rates.force[a];
        double uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
        if (uu < l->rates.limit && fabs(r) < 1e30) continue;
        if (!fluid || filtration__in_film(l, x, y, z)) {
            const double rest = fluid ? filtration__film_density(l, x, y, z) : 0.0;
            for (int i = 0; i < l->q; i++) filtration__put(l, filtration__outgoing(l, x, y, z, i), l->w[i] * rest);
            continue;
        }
        problem->cause = uu < HUGE_VAL ? FILTRATION_SPEED : FILTRATION_NOT_FINITE;
        problem->node[0] = x, problem->node[1] = y, problem->node[2] = z;
        problem->speed = sqrt(uu);
        return 1;
    }
    return 0;
}
