/* The two sets of directions, the layout of populations in memory, and where a step finds them. */
#pragma once
#include "api.h"

/* ==== >>lattice ==== */

#define FILTRATION__Q 19     /* largest number of directions */
#define FILTRATION__LINE 64  /* bytes of a cache line: rows begin on one */
#define FILTRATION__TASKS 64 /* parts of a step that threads share: a fixed number, so that sums have a fixed order */
#define FILTRATION__FLUID (-1)
#define FILTRATION__SOLID (-2)
#define FILTRATION__FRESH (-3) /* left by a sphere, not yet filled */
enum { FILTRATION__ROW_SOLID = 1, FILTRATION__ROW_BAD = 2 };

/* Directions: rest, then pairs of opposite ones, so that the opposite of i needs no table. */
static const signed char filtration__c19[19][3] = {{0, 0, 0},  {1, 0, 0},   {-1, 0, 0},  {0, 1, 0},   {0, -1, 0},
                                                   {0, 0, 1},  {0, 0, -1},  {1, 1, 0},   {-1, -1, 0}, {1, -1, 0},
                                                   {-1, 1, 0}, {1, 0, 1},   {-1, 0, -1}, {1, 0, -1},  {-1, 0, 1},
                                                   {0, 1, 1},  {0, -1, -1}, {0, 1, -1},  {0, -1, 1}};
static const signed char filtration__c15[15][3] = {{0, 0, 0},   {1, 0, 0},  {-1, 0, 0},  {0, 1, 0},    {0, -1, 0},
                                                   {0, 0, 1},   {0, 0, -1}, {1, 1, 1},   {-1, -1, -1}, {1, 1, -1},
                                                   {-1, -1, 1}, {1, -1, 1}, {-1, 1, -1}, {-1, 1, 1},   {1, -1, -1}};

static inline int filtration__opposite(int i) { return i ? ((i - 1) ^ 1) + 1 : 0; }

/* A link of the solid at rest, from fluid node (x, y, z) along i. */
typedef struct filtration__link {
    int32_t x, y, z, i;
    float fraction; /* q [-] */
} filtration__link;

/* A population that enters a node through a face, opposite to direction i, which leaves. It is computed from the
   population that leaves the node at `offset` along `along`. */
typedef struct filtration__entry {
    signed char i, face, offset[3], along;
} filtration__entry;

/* A sphere in lattice units, as in the owner map. */
typedef struct filtration__ball {
    double centre[3], velocity[3], spin[3], radius; /* radius 0: no sphere */
    double force[2][3], torque[2][3];               /* of this step and the one before */
    double density, slope[3]; /* at its surface: deviation density + slope . d, d from the centre */
    int64_t steps;            /* number of steps since it was added */
    int64_t films;            /* number of links to other solids and through faces */
    int64_t hull[3];          /* sum over its links of 72 w c [-]: 0 where its surface is closed */
} filtration__ball;

#define FILTRATION__NEAR 24  /* most gaps to other spheres that a sphere lists */
#define FILTRATION__PUSHES 5 /* sums over a gap */

/* A gap between a sphere and another one near it, or a face. */
typedef struct filtration__near {
    int32_t other;         /* -1: a face */
    double normal[3], gap; /* towards the other; [nodes], 0 where they touch */
    double cap;            /* the surface farther than this along the normal, from the centre, belongs to the gap
                              [nodes] */
    double push[FILTRATION__PUSHES]; /* along the normal: from its links in the gap, and from a density and slopes of 1
                                        there */
} filtration__near;

/* The gaps beside a sphere. */
typedef struct filtration__gaps {
    int count;
    filtration__near near[FILTRATION__NEAR];
} filtration__gaps;

/* Relaxation and forcing of one step, of the kernel's precision. */
typedef struct filtration__rates {
    double plus, minus, bulk; /* rates [-] of even and odd parts and of the trace of the stress */
    double force[3];          /* on a node, in lattice units [-] */
    double limit;             /* of the squared speed [-] */
} filtration__rates;

typedef struct filtration__lattice {
    int q, single; /* number of directions; 1: floats */
    int nx, ny, nz;
    int ghost_y, ghost_z;     /* 1: rows beyond the faces exist */
    int lead;                 /* numbers before node 0 of a row; the last one is the halo */
    ptrdiff_t stride, bundle; /* numbers between directions, between rows */
    ptrdiff_t rows;           /* number of rows, with ghosts */
    void *f;                  /* deviations h = f - w [-] */
    void *block;              /* allocated block that contains f */
    size_t block_bytes;
    const signed char (*c)[3];
    const struct filtration__face_kind *face[6];
    double face_velocity[6][3], face_density[6]; /* lattice units [-] */
    double w[FILTRATION__Q];
    int whole_weight[FILTRATION__Q]; /* 72 w */
    double real_c[FILTRATION__Q][3], squared_c[FILTRATION__Q];
    filtration__rates rates;
    int periodic_x, half_way, refill;
    int repeats[3]; /* 1: the axis is periodic */
    /* For nodes whose neighbours all lie in the box, between steps; the first index is `odd`. Where an outgoing and an
       incoming population is, relative to the node; how far the next node is, in places and in nodes. */
    ptrdiff_t out_at[2][FILTRATION__Q], in_at[2][FILTRATION__Q], next_place[FILTRATION__Q], next_node[FILTRATION__Q];
    int left;                   /* 1: spheres have left nodes since the mass was corrected */
    int odd;                    /* which step of the pair comes next */
    int32_t *owner;             /* [nz][ny][nx]: FILTRATION__FLUID, FILTRATION__SOLID or a sphere */
    unsigned char *row_state;   /* [nz][ny]: FILTRATION__ROW_SOLID, FILTRATION__ROW_BAD */
    unsigned char *slab_active; /* [nz]: 0: at exact rest */
    filtration__link *links;
    ptrdiff_t link_count;
    int entry_count[64]; /* of nodes beside faces: low and high of an axis have a bit each */
    filtration__entry entries[64][FILTRATION__Q];
    filtration__ball *balls;
    ptrdiff_t ball_count, ball_room;
    filtration__gaps *gaps; /* [gap_room], of the spheres in the last step */
    ptrdiff_t gap_room;
    ptrdiff_t fluid_nodes, solid_nodes;
    double to_velocity, to_pressure, to_force; /* SI per lattice unit */
    double reduce[FILTRATION__TASKS][8];       /* sums of tasks */
    int bad[FILTRATION__TASKS];                /* 1: a row of the task is FILTRATION__ROW_BAD */
    int64_t updated[FILTRATION__TASKS];        /* nodes */
} filtration__lattice;

static inline double filtration__dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Returns the deviation of density at a sphere's surface, or in a film beside it; d: from its centre. */
static inline double filtration__density_at(const filtration__ball *b, const double d[3]) {
    return b->density + filtration__dot(b->slope, d);
}

/* Returns a coordinate on an axis of n nodes, wrapped; i is at most n beyond. */
static inline int filtration__wrap(int i, int n) { return i < 0 ? i + n : i >= n ? i - n : i; }

/* Returns the row at (y, z), each -1 .. n: wrapped on periodic axes, a ghost row beyond other faces. */
static inline ptrdiff_t filtration__row(const filtration__lattice *l, int y, int z) {
    y = l->ghost_y ? y + 1 : filtration__wrap(y, l->ny);
    z = l->ghost_z ? z + 1 : filtration__wrap(z, l->nz);
    return (ptrdiff_t)z * (l->ny + 2 * l->ghost_y) + y;
}

/* Returns the place of direction i at node x of a row. */
static inline ptrdiff_t filtration__place(const filtration__lattice *l, ptrdiff_t row, int i, int x) {
    return row * l->bundle + i * l->stride + l->lead + x;
}

static inline double filtration__get(const filtration__lattice *l, ptrdiff_t place) {
    return l->single ? (double)((const float *)l->f)[place] : ((const double *)l->f)[place];
}

static inline void filtration__put(filtration__lattice *l, ptrdiff_t place, double h) {
    if (l->single) ((float *)l->f)[place] = (float)h;
    else ((double *)l->f)[place] = h;
}

/* Returns where a population is stored at its own node. There is only one lattice, updated in place (Bailey et al.
   2009): an even step reads and writes at the node itself, an odd one at its neighbours. Both write each outgoing
   population where they read the opposite one. So a population is stored `home` or `abroad`. */
static inline ptrdiff_t filtration__home(const filtration__lattice *l, int x, int y, int z, int i) {
    return filtration__place(l, filtration__row(l, y, z), i, x);
}

/* Returns where an odd step reads direction i of a node: the opposite slot of the node that it comes from. */
static inline ptrdiff_t filtration__abroad(const filtration__lattice *l, int x, int y, int z, int i) {
    const signed char *c = l->c[i];
    return filtration__place(l, filtration__row(l, y - c[1], z - c[2]), filtration__opposite(i), x - c[0]);
}

/* Returns where the last step left the outgoing population i of a node; between steps. */
static inline ptrdiff_t filtration__outgoing(const filtration__lattice *l, int x, int y, int z, int i) {
    int j = filtration__opposite(i);
    return l->odd ? filtration__home(l, x, y, z, j) : filtration__abroad(l, x, y, z, j);
}

/* Returns where the next step reads the incoming population i of a node; between steps. */
static inline ptrdiff_t filtration__incoming(const filtration__lattice *l, int x, int y, int z, int i) {
    if (l->odd) return filtration__abroad(l, x, y, z, i);
    if (l->periodic_x && x == 0 && l->c[i][0] > 0)
        x = l->nx; /* still in the halo, which is folded back when the step begins */
    else if (l->periodic_x && x == l->nx - 1 && l->c[i][0] < 0) x = -1;
    return filtration__home(l, x, y, z, i);
}

static inline ptrdiff_t filtration__node(const filtration__lattice *l, int x, int y, int z) {
    return ((ptrdiff_t)z * l->ny + y) * l->nx + x;
}

/* Finds the places of populations of nodes whose neighbours all lie in the box. */
static inline void filtration__list_places(filtration__lattice *l) {
    for (int i = 0; i < l->q; i++) {
        const signed char *c = l->c[i];
        const int o = filtration__opposite(i);
        l->next_place[i] = ((ptrdiff_t)c[2] * (l->ny + 2 * l->ghost_y) + c[1]) * l->bundle + c[0];
        l->next_node[i] = ((ptrdiff_t)c[2] * l->ny + c[1]) * l->nx + c[0];
        l->out_at[0][i] = l->next_place[i] + i * l->stride, l->out_at[1][i] = o * l->stride;
        l->in_at[0][i] = i * l->stride, l->in_at[1][i] = o * l->stride - l->next_place[i];
    }
}

/* Returns whether all neighbours of a node lie in the box. */
static inline int filtration__is_inner(const filtration__lattice *l, int x, int y, int z) {
    return x > 0 && y > 0 && z > 0 && x < l->nx - 1 && y < l->ny - 1 && z < l->nz - 1;
}

/* Returns the place of direction 0 of such a node, as filtration__home does. */
static inline ptrdiff_t filtration__inner_place(const filtration__lattice *l, int x, int y, int z) {
    return ((ptrdiff_t)(z + l->ghost_z) * (l->ny + 2 * l->ghost_y) + y + l->ghost_y) * l->bundle + l->lead + x;
}

/* Returns the equilibrium of direction i: weight times r + 3 c.u + 4.5 (c.u)^2 - 1.5 u^2 (He and Luo 1997). */
static inline double filtration__equilibrium(const filtration__lattice *l, int i, double r, const double u[3]) {
    const signed char *c = l->c[i];
    double cu = c[0] * u[0] + c[1] * u[1] + c[2] * u[2];
    return l->w[i] * (r + 3.0 * cu + 4.5 * cu * cu - 1.5 * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]));
}
