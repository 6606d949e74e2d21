/* Populations that enter through non-periodic faces of the box: walls, given pressure, symmetry. */
#pragma once
#include "collide.h"

/* ==== >>faces ==== */

#define FILTRATION__BLOCK 64 /* nodes that a face processes together */

/* What lies beyond a face. */
enum { FILTRATION__NOTHING, FILTRATION__REPEATED, FILTRATION__MIRRORED };

/* A kind of face; filtration__face_kinds has a row for each. */
typedef struct filtration__face_kind {
    filtration_face kind;
    int beyond;
    int rank;         /* at an edge of the box a population belongs to the face of the highest rank */
    int is_touched;   /* 1: spheres touch it */
    int has_velocity; /* 1: along the face, 2: through it, too */
    int has_pressure;
    int reads_flow; /* 1: enter needs the velocity of the nodes */
    /* Computes the populations that enter n nodes from those that leave, h. u: their velocity, or 0. NULL: leaving ones
       enter again. */
    void (*enter)(const filtration__lattice *l, const filtration__entry *e, int n, double u[3][FILTRATION__BLOCK],
                  double *h);
} filtration__face_kind;

/* Half-way bounce-back from a surface that moves along itself, or through which liquid enters. */
FILTRATION__STATIC void filtration__enter_wall(const filtration__lattice *l, const filtration__entry *e, int n,
                                               double u[3][FILTRATION__BLOCK], double *h) {
    const signed char *c = l->c[e->i];
    const double *v = l->face_velocity[e->face], push = 6.0 * l->w[e->i] * (c[0] * v[0] + c[1] * v[1] + c[2] * v[2]);
    (void)u;
    for (int k = 0; k < n; k++) h[k] -= push;
}

/* A given pressure by anti-bounce-back (Ginzburg et al. 2008). */
FILTRATION__STATIC void filtration__enter_open(const filtration__lattice *l, const filtration__entry *e, int n,
                                               double u[3][FILTRATION__BLOCK], double *h) {
    const signed char *c = l->c[e->i];
    const double r = l->face_density[e->face];
    for (int k = 0; k < n; k++) {
        double cu = c[0] * u[0][k] + c[1] * u[1][k] + c[2] * u[2][k];
        double uu = u[0][k] * u[0][k] + u[1][k] * u[1][k] + u[2][k] * u[2][k];
        h[k] = 2.0 * l->w[e->i] * (r + 4.5 * cu * cu - 1.5 * uu) - h[k];
    }
}

/* A given pressure where liquid leaves; where it enters, with the energy of a vessel at rest (Bruneau and
   Fabrie 1994). */
FILTRATION__STATIC void filtration__enter_outlet(const filtration__lattice *l, const filtration__entry *e, int n,
                                                 double u[3][FILTRATION__BLOCK], double *h) {
    const double into = e->face & 1 ? -1.0 : 1.0, *through = u[e->face / 2];
    filtration__enter_open(l, e, n, u, h);
    for (int k = 0; k < n; k++) {
        const double uu = u[0][k] * u[0][k] + u[1][k] * u[1][k] + u[2][k] * u[2][k];
        if (into * through[k] > 0.0) h[k] -= 3.0 * l->w[e->i] * uu;
    }
}

/* clang-format off */
static const filtration__face_kind filtration__face_kinds[] = {
    /* kind                 beyond                 rank  touched velocity pressure reads flow  enter */
    {FILTRATION_PERIODIC, FILTRATION__REPEATED, 0, 0, 0, 0, 0, NULL},
    {FILTRATION_WALL,     FILTRATION__NOTHING,  3, 1, 1, 0, 0, filtration__enter_wall},
    {FILTRATION_PRESSURE, FILTRATION__NOTHING,  2, 0, 0, 1, 1, filtration__enter_open},
    {FILTRATION_SYMMETRY, FILTRATION__MIRRORED, 1, 0, 0, 0, 0, NULL},
    /* Ranks before walls, so that all of the flow enters. */
    {FILTRATION_INFLOW,   FILTRATION__NOTHING,  4, 0, 2, 0, 0, filtration__enter_wall},
    {FILTRATION_OUTLET,   FILTRATION__NOTHING,  2, 0, 0, 1, 1, filtration__enter_outlet},
};
/* clang-format on */

/* Returns the row of a kind, or NULL. */
static inline const filtration__face_kind *filtration__kind_of(filtration_face kind) {
    for (size_t k = 0; k < sizeof filtration__face_kinds / sizeof *filtration__face_kinds; k++)
        if (filtration__face_kinds[k].kind == kind) return &filtration__face_kinds[k];
    return NULL;
}

static inline int filtration__repeats(const filtration__lattice *l, int axis) {
    return l->face[2 * axis]->beyond == FILTRATION__REPEATED;
}

/* Returns the direction with the signs of some axes (as bits) reversed. */
static inline int filtration__turned(const filtration__lattice *l, int i, int axes) {
    for (int j = 0; j < l->q; j++) {
        int same = 1;
        for (int a = 0; a < 3; a++) same &= l->c[j][a] == ((axes >> a & 1) ? -l->c[i][a] : l->c[i][a]);
        if (same) return j;
    }
    return i;
}

/* Moves p, beyond the box by at most one node, into the box: wrapped, or mirrored with the axes as bits in *mirrored.
   Returns 0 beyond walls and open faces. */
static inline int filtration__inside(const filtration__lattice *l, int p[3], int *mirrored) {
    const int n[3] = {l->nx, l->ny, l->nz};
    *mirrored = 0;
    for (int a = 0; a < 3; a++) {
        if (p[a] >= 0 && p[a] < n[a]) continue;
        const int beyond = l->face[2 * a + (p[a] > 0)]->beyond;
        if (beyond == FILTRATION__REPEATED) {
            p[a] %= n[a];
            if (p[a] < 0) p[a] += n[a];
        } else if (beyond == FILTRATION__MIRRORED && p[a] >= -1 && p[a] <= n[a]) {
            p[a] = p[a] < 0 ? -1 - p[a] : 2 * n[a] - 1 - p[a];
            *mirrored |= 1 << a;
        } else {
            return 0;
        }
    }
    return 1;
}

static inline void filtration__load(const filtration__lattice *l, ptrdiff_t place, int n, double *h) {
    if (l->single)
        for (int k = 0; k < n; k++) h[k] = (double)((const float *)l->f)[place + k];
    else memcpy(h, (const double *)l->f + place, (size_t)n * sizeof *h);
}

static inline void filtration__store(filtration__lattice *l, ptrdiff_t place, int n, const double *h) {
    if (l->single)
        for (int k = 0; k < n; k++) ((float *)l->f)[place + k] = (float)h[k];
    else memcpy((double *)l->f + place, h, (size_t)n * sizeof *h);
}

/* Computes the velocity of n nodes of a row after collision. */
static inline void filtration__row_velocity(const filtration__lattice *l, int x, int n, int y, int z,
                                            double u[3][FILTRATION__BLOCK]) {
    double h[FILTRATION__BLOCK];
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < n; k++) u[a][k] = -0.5 * l->rates.force[a];
    for (int i = 1; i < l->q; i++) {
        filtration__load(l, filtration__outgoing(l, x, y, z, i), n, h);
        for (int a = 0; a < 3; a++)
            for (int k = 0; l->c[i][a] && k < n; k++) u[a][k] += l->c[i][a] * h[k];
    }
}

/* Finds how the opposite of direction i enters a node beside these faces (2 bits an axis: low, high). Returns 0 if it
   does not enter through a face. */
static inline int filtration__find_entry(const filtration__lattice *l, int beside, int i, filtration__entry *e) {
    int rank = 0, crossed = 0;
    memset(e, 0, sizeof *e);
    for (int a = 0; a < 3; a++) {
        const int c = l->c[i][a], f = 2 * a + (c > 0);
        if (c == 0 || !(beside >> f & 1) || l->face[f]->beyond == FILTRATION__REPEATED) continue;
        crossed |= 1 << a;
        if (l->face[f]->rank > rank) rank = l->face[f]->rank, e->face = (signed char)f;
    }
    if (!crossed) return 0;
    e->i = e->along = (signed char)i;
    if (l->face[e->face]->beyond != FILTRATION__MIRRORED) return 1;
    for (int a = 0; a < 3; a++) e->offset[a] = (crossed >> a & 1) ? (signed char)0 : l->c[i][a];
    e->along = (signed char)filtration__turned(l, i, 7 & ~crossed);
    return 1;
}

/* Lists the populations that enter through faces, for nodes beside any of them. */
static inline void filtration__list_entries(filtration__lattice *l) {
    for (int beside = 0; beside < 64; beside++) {
        l->entry_count[beside] = 0;
        for (int i = 1; i < l->q; i++)
            l->entry_count[beside] += filtration__find_entry(l, beside, i, &l->entries[beside][l->entry_count[beside]]);
    }
}

static inline int filtration__beside(int i, int n) { return (i == 0) + 2 * (i == n - 1); }

/* Processes n nodes of a row, at most FILTRATION__BLOCK, beside the same faces. */
static inline void filtration__face_block(filtration__lattice *l, int x, int n, int y, int z) {
    double u[3][FILTRATION__BLOCK] = {{0.0}}, h[FILTRATION__BLOCK];
    const int beside =
        filtration__beside(x, l->nx) + 4 * filtration__beside(y, l->ny) + 16 * filtration__beside(z, l->nz);
    int have_velocity = 0;
    for (int k = 0; k < l->entry_count[beside]; k++) {
        const filtration__entry *e = &l->entries[beside][k];
        const filtration__face_kind *kind = l->face[e->face];
        int m[3] = {x + e->offset[0], y + e->offset[1], z + e->offset[2]}, none;
        filtration__inside(l, m, &none);
        filtration__load(l, filtration__outgoing(l, m[0], m[1], m[2], e->along), n, h);
        if (kind->reads_flow && !have_velocity) filtration__row_velocity(l, x, n, y, z, u), have_velocity = 1;
        if (kind->enter) kind->enter(l, e, n, u, h);
        filtration__store(l, filtration__incoming(l, x, y, z, filtration__opposite(e->i)), n, h);
    }
}

/* A wall beside a node whose other neighbours lie in the box. */
static inline void filtration__wall_node(filtration__lattice *l, int x, int y, int z) {
    const int beside = filtration__beside(x, l->nx);
    const ptrdiff_t place = filtration__inner_place(l, x, y, z), *out = l->out_at[l->odd], *in = l->in_at[l->odd];
    for (int k = 0; k < l->entry_count[beside]; k++) {
        const filtration__entry *e = &l->entries[beside][k];
        double h = filtration__get(l, place + out[e->i]);
        filtration__enter_wall(l, e, 1, NULL, &h);
        filtration__put(l, place + in[filtration__opposite(e->i)], h);
    }
}

/* Computes the populations that enter a row from those that left it. */
static inline void filtration__face_row(filtration__lattice *l, int y, int z) {
    const int at_end = y == 0 || y == l->ny - 1 || z == 0 || z == l->nz - 1;
    const int at_face = (l->ghost_y && (y == 0 || y == l->ny - 1)) || (l->ghost_z && (z == 0 || z == l->nz - 1));
    if (!at_face && l->periodic_x) return;
    for (int x = 0; x < l->nx; x += l->nx > 1 ? l->nx - 1 : 1) {
        if (!at_end && l->nx > 1 && l->face[x > 0]->enter == filtration__enter_wall) filtration__wall_node(l, x, y, z);
        else filtration__face_block(l, x, 1, y, z);
    }
    for (int x = 1; at_face && x < l->nx - 1; x += FILTRATION__BLOCK)
        filtration__face_block(l, x, l->nx - 1 - x < FILTRATION__BLOCK ? l->nx - 1 - x : FILTRATION__BLOCK, y, z);
}

/* Mirrored faces read other rows, so they wait until all rows are done. */
static inline int filtration__faces_wait(const filtration__lattice *l) {
    int wait = 0;
    for (int f = 0; f < 6; f++) wait |= l->face[f]->beyond == FILTRATION__MIRRORED;
    return wait;
}

/* The faces of a row follow its collision while its populations are in the cache. */
FILTRATION__STATIC void filtration__collide_task(void *context, int task) {
    filtration__lattice *l = (filtration__lattice *)context;
    ptrdiff_t first, end;
    filtration__task_range((ptrdiff_t)l->ny * l->nz, task, &first, &end);
    const int wait = filtration__faces_wait(l);
    l->bad[task] = 0;
    l->updated[task] = 0;
    for (ptrdiff_t k = first; k < end; k++) {
        int y = (int)(k % l->ny), z = (int)(k / l->ny);
        if (!l->slab_active[z] || (l->row_state[k] & FILTRATION__ROW_SOLID)) continue;
        filtration__collide_at(l, y, z);
        if (!wait) filtration__face_row(l, y, z);
        l->bad[task] |= l->row_state[k] & FILTRATION__ROW_BAD;
        l->updated[task] += l->nx;
    }
}

FILTRATION__STATIC void filtration__face_task(void *context, int task) {
    filtration__lattice *l = (filtration__lattice *)context;
    ptrdiff_t first, end;
    filtration__task_range((ptrdiff_t)l->ny * l->nz, task, &first, &end);
    for (ptrdiff_t k = first; k < end; k++) {
        int y = (int)(k % l->ny), z = (int)(k / l->ny);
        if (l->slab_active[z] && !(l->row_state[k] & FILTRATION__ROW_SOLID)) filtration__face_row(l, y, z);
    }
}

/* Returns whether a row marked bad has a bad fluid node. */
static inline int filtration__find_problem(filtration__lattice *l, filtration_problem *problem) {
    const int wait = filtration__faces_wait(l);
    for (int task = 0; task < FILTRATION__TASKS; task++) {
        ptrdiff_t first, end;
        filtration__task_range((ptrdiff_t)l->ny * l->nz, task, &first, &end);
        for (ptrdiff_t k = first; l->bad[task] && k < end; k++) {
            if (!(l->row_state[k] & FILTRATION__ROW_BAD)) continue;
            l->row_state[k] = (unsigned char)(l->row_state[k] & ~FILTRATION__ROW_BAD);
            if (filtration__bad_node(l, (int)(k % l->ny), (int)(k / l->ny), problem)) return 1;
            /* a node may have been put to rest */
            if (!wait) filtration__face_row(l, (int)(k % l->ny), (int)(k / l->ny));
        }
    }
    return 0;
}
