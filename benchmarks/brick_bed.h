/* brick_bed.h: a bed of bricks of 1 : 1 : 2.08 that the benchmarks run, or of as many clumps of two spheres that touch,
   or spheres of the brick's volume. They fall, turned at random, into a box that is periodic sideways. k_n
   1e4 N/m, e = 0.3, friction 0.5, 3e-6 s. */
#ifndef RIDDLE_BRICK_BED_H
#define RIDDLE_BRICK_BED_H

#include <stdint.h>
#include <string.h>

#include "dem.h"

static const double brick_edge = 2e-3, brick_density = 2500.0, brick_stiffness = 1e4, brick_spacing = 5.2e-3;
enum { BRICKS_ACROSS = 7 }; /* bodies of a layer, along each side */

/* What a bed is made of. */
typedef struct brick_kind {
    int shape, number; /* 0 brick, 1 clump, 2 sphere; of the brick in the world */
    dem_clump clump;
    double diameter; /* of a sphere of the brick's volume [m] */
} brick_kind;

static inline dem_status brick_prepare(dem_world *w, int shape, brick_kind *k) {
    dem_convex brick;
    const double two =
        0.25 * 1.58740105196820 * brick_edge * 1.58375586998611; /* radius of each of a clump's spheres [m] */
    const double centres[6] = {0, 0, -two, 0, 0, two}, diameters[2] = {2.0 * two, 2.0 * two};
    k->shape = shape, k->number = 0, k->diameter = brick_edge * 1.58375586998611;
    dem_status status = dem_make_brick(&brick, dem_vec3(brick_edge, brick_edge, 2.08 * brick_edge), 0.03, NULL);
    if (status == DEM_OK) status = dem_make_clump(2, centres, diameters, &k->clump);
    if (status == DEM_OK && shape == 0) k->number = dem_add_shape(w, &brick);
    return k->number < 0 ? (dem_status)-k->number : status;
}

static inline dem_status brick_add(dem_world *w, const brick_kind *k, dem_vec x, dem_quaternion turn, dem_vec velocity,
                                   dem_vec spin) {
    const double at[3] = {x.x, x.y, x.z}, q[4] = {turn.w, turn.x, turn.y, turn.z};
    dem_status status;
    if (k->shape == 0) status = dem_add_convex(w, k->number, 1, at, q, 0, 0);
    else if (k->shape == 1) status = dem_add_clumps(w, 1, &k->clump, at, NULL, q, 0, 0);
    else status = dem_add_spheres(w, 1, at, &k->diameter, 0, 0);
    return status == DEM_OK ? dem_set_motion(w, w->count - 1, velocity, spin) : status;
}

static inline dem_status brick_add_layers(dem_world *w, int shape, int n, uint64_t seed) {
    brick_kind own;
    dem_status status = brick_prepare(w, shape, &own);
    for (int k = 0; k < n && status == DEM_OK; k++) {
        const int layer = k / (BRICKS_ACROSS * BRICKS_ACROSS);
        const dem_vec at =
            dem_vec3((0.5 + k % BRICKS_ACROSS) * brick_spacing,
                     (0.5 + k / BRICKS_ACROSS % BRICKS_ACROSS) * brick_spacing, (0.6 + layer) * brick_spacing);
        status = brick_add(w, &own, at, dem__random_turn(&seed), dem_vec3(0, 0, -0.3), dem_vec3(0, 0, 0));
    }
    return status;
}

/* A box without bodies. */
static inline dem_status brick_box(dem_world *w, double side, int *floor_wall) {
    dem_def def = dem_default_def();
    const int material = dem_add_material(&def, brick_density, 1e7, 0.3);
    dem_pair_def *pair = dem_pair(&def, material, material);
    pair->stiffness = brick_stiffness, pair->restitution = 0.3, pair->friction = 0.5;
    def.dt = 3e-6, def.threads = 1;
    def.periodic[0] = def.periodic[1] = 1;
    def.high.x = def.high.y = side;
    const dem_status status = dem_init(w, &def, NULL);
    *floor_wall = status == DEM_OK ? dem_add_plane(w, material, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) : 0;
    return *floor_wall < 0 ? (dem_status) - *floor_wall : status;
}

/* Replaces a world by tiles x tiles copies of it beside each other, which fit, as it is periodic. */
static inline dem_status brick_repeat(dem_world *w, int shape, int tiles, double side, int *floor_wall) {
    dem_world wide;
    brick_kind own;
    memset(&wide, 0, sizeof wide);
    dem_status status = brick_box(&wide, tiles * side, floor_wall);
    if (status == DEM_OK) status = brick_prepare(&wide, shape, &own);
    for (int tile = 0; tile < tiles * tiles; tile++) {
        for (ptrdiff_t i = 0; i < w->count && status == DEM_OK; i++) {
            const dem_body b = dem_get_body(w, i);
            const dem_vec at =
                dem_vec3(b.position.x + tile % tiles * side, b.position.y + tile / tiles * side, b.position.z);
            if (b.first == i) status = brick_add(&wide, &own, at, b.orientation, b.velocity, b.spin);
        }
    }
    dem_free(w);
    *w = wide;
    return status;
}

#endif
