/* The engine's state of polyhedra. */
#pragma once
#include "polyhedron.h"

/* Placement of a core: its centre [m] and the directions of its own axes. */
typedef struct dem__placed {
    dem_vec x, axis[3];
} dem__placed;

/* The corners that were nearest at the last test of a pair: 12 bytes that speed up the search for the distance and do
   not change it. */
typedef struct dem__nearest_cache {
    uint8_t n, a[4], b[4], unused[3];
} dem__nearest_cache;

/* A point where two rounded cores a and b touch: a sphere of a's radius about `at` touches one of b's radius about at -
   (gap + radii) normal. */
typedef struct dem__convex_point {
    int32_t key;        /* 0 .. 31: corner of a; 32 .. 63: corner of b; from 64 on: a crossing of edges, or one of its
                           ends */
    int32_t taken;      /* a contact uses it */
    dem_vec normal, at; /* from b to a; [m] */
    double gap, weight; /* [m]; factor of the spring: 1, or what an end takes back from a crossing, at least -1, over
                           the springs of its body; later its part of the pair's law */
    double count;       /* for a corner 1, for a crossing what its ends leave, for an end 0; over the springs of its
                           body */
    double pull;        /* its part of the pair's pull, over the force of its spring */
    double damping;     /* factor of the closing speed in the law */
} dem__convex_point;

/* Two bodies that may touch, at least one of them a polyhedron: particles i < j, or particle i and wall -1 - j. */
typedef struct dem__convex_pair {
    int32_t i, j, near;   /* near: index of its near pair, or -1 */
    int32_t first, count; /* of its points in the present step */
    int32_t is_close;     /* whether the spheres around the two touch in the present step */
    int32_t lead, next;   /* for a part of a compound: the first pair of its two bodies, and the next pair; -1: none */
    int64_t skip_until;   /* step before which they cannot touch as long as both stay in flight and the wall is no
                             faster */
    int64_t origin[2];    /* origin steps of these flights */
    double speed, spin;   /* bounds of the wall's motion that this relies on [m/s], [rad/s] */
    dem__nearest_cache cache;
    dem_vec axis;   /* a direction in which the cores were apart at the last test; 0: none */
    double depth;   /* of overlapping cores along it, in the present step [m]; 0: they do not overlap */
    double pull[9]; /* force by which the springs of its points exceed their parts in the law, over the stiffness: force
                       on i, torques on i and j */
} dem__convex_pair;

/* The functions that the engine calls for polyhedra, in the order of a step; they are in polyhedra/add.h. The first
   shape of a world sets the table, so that a program that neither adds a shape nor loads a world compiles none of
   them. */
struct dem__rows;
struct dem__type_rows;
struct dem__wall_row;
struct dem__columns;
struct dem__chunk;
typedef struct dem__convex_calls {
    void (*prepare)(const dem_world *w, ptrdiff_t c, dem_birth *b); /* sets sizes and mass of the contact in slot c */
    void (*fill_rows)(const dem_world *w, struct dem__rows *b, const struct dem__type_rows *t, ptrdiff_t base, int n,
                      double half, struct dem__wall_row *wall); /* fills rows of a block before the law */
    void (*finish_rows)(const dem_world *w, const struct dem__rows *b, const struct dem__type_rows *t, ptrdiff_t base,
                        int n, const struct dem__columns *at, const double *before, double half,
                        int features); /* forces and torques after the
                                                                                                            law; before:
                                          contact forces */
    dem_status (*add)(dem_world *w, int shape, ptrdiff_t n, const double *centres, const double *orientations,
                      int material, int group); /* adds polyhedra: dem_add_convex, for feeds */
    void (*leave_edges)(dem_world *w, const struct dem__chunk *in,
                        ptrdiff_t marked); /* excludes polyhedra from partial steps */
} dem__convex_calls;

/* Polyhedra. polyhedra/add.h adds shapes, polyhedra/pairs.h lists pairs and finds their points. All of it is zero until
   there is a shape. */
typedef struct dem__convex_state {
    const dem__convex_calls *calls; /* NULL without shapes */
    dem_convex *shape;
    int shapes, has_parts;  /* has_parts: whether there has been a compound */
    int32_t *shape_of;      /* for a particle: index of its shape + 1, or 0 for a sphere; NULL without shapes */
    dem_quaternion *part;   /* for a part of a compound: from its own axes to the principal axes of its body; else 0 */
    dem__placed *place;     /* for a polyhedron: its placement at the end of the present step */
    dem__convex_pair *pair; /* pairs of particles in the order of near pairs, then pairs with walls in the order of
                               particles and walls */
    ptrdiff_t pairs, of_particles, pair_capacity;
    int32_t *close;   /* [pair_capacity] numbers of the pairs that are close in the present step, and of the first pairs
                         of compounds, rising */
    ptrdiff_t closes; /* how many */
    dem__convex_point *point;
    ptrdiff_t point_capacity;
    int64_t overlaps;      /* of cores, in the last step */
    int64_t overlap_steps; /* overlaps of cores, and cores that walls cut, summed over all steps */
} dem__convex_state;
