/* Two overlapping cores are pushed apart along the direction of least overlap. Reads shapes, places and the points of a
   pair; adds one point and lowers the weights of the others. Promises: forces stay the gradient of a potential (of a
   linear law); nothing jumps where cores begin to overlap; deep cores can only move apart. */
#pragma once
#include "share.h"

#define DEM__DEEP 1.0 /* overlap of cores, over the radii of the roundings, from which on only this point acts */

/* The corners of a core that are farthest along a direction: how many, their mean, and two of them. */
typedef struct dem__farthest_part {
    int n;
    dem_vec mean, end[2];
} dem__farthest_part;
static inline dem__farthest_part dem__find_part(const dem_convex *s, const dem__placed *p, dem_vec along) {
    const dem_vec u = dem__into_core(p, along);
    const double limit = dem__dot(u, dem__point(s->corner[dem__farthest(s, u)])) - 1e-6 * s->reach;
    dem__farthest_part part;
    part.n = 0, part.mean = part.end[0] = part.end[1] = dem_vec3(0.0, 0.0, 0.0);
    for (int k = 0; k < s->corners; k++) {
        if (!(dem__dot(u, dem__point(s->corner[k])) >= limit)) continue;
        const dem_vec x = dem__corner_at(s, p, k);
        part.end[part.n > 0] = x, part.mean = dem__add(part.mean, x), part.n++;
    }
    part.mean = dem__scale(1.0 / (double)part.n, part.mean);
    return part;
}

/* Returns the point, on a, at which two cores touch once they have moved apart along n. */
static inline dem_vec dem__meeting_point(const dem__farthest_part *a, const dem__farthest_part *b) {
    if (a->n == 2 && b->n == 2) {
        const dem_vec u = dem__sub(a->end[1], a->end[0]), v = dem__sub(b->end[1], b->end[0]),
                      d = dem__sub(b->end[0], a->end[0]);
        const double uu = dem__dot(u, u), vv = dem__dot(v, v), uv = dem__dot(u, v), square = uu * vv - uv * uv;
        if (square > 1e-6 * uu * vv)
            return dem__plus(a->end[0], dem__clamp((dem__dot(d, u) * vv - dem__dot(d, v) * uv) / square, 0.0, 1.0), u);
    }
    return a->n <= b->n ? a->mean : b->mean;
}

/* Multiplies the sums of a pair, whose springs are then more than its parts. */
static inline void dem__scale_shared(dem__shared *s, double by) {
    if (s->are_parts) s->pull = s->normal, s->pull_on_i = s->on_i;
    s->are_parts = 0;
    s->energy *= by, s->parts *= by, s->springs *= by, s->whole *= by;
    s->normal = dem__scale(by, s->normal), s->on_i = dem__scale(by, s->on_i);
    s->pull = dem__scale(by, s->pull), s->pull_on_i = dem__scale(by, s->pull_on_i);
}

/* Adds to the n points of a pair the one at which two overlapping cores are pushed apart. With U, the energy of the
   other points over k/p, and V = (radii + depth)^p, that of the new one, the energy of the pair is (1 - s) U + s V,
   where s goes from 0 to 1 with the depth. Forces are its gradient. Returns the number of points. There must be room
   for one more. power: p. */
static DEM__NOINLINE int dem__push_apart(const dem_convex *a, const dem__placed *pa, const dem_convex *b,
                                         const dem__placed *pb, const dem__gap_of_cores *gap, double power,
                                         dem__shared *sums, dem__convex_point *out, int n) {
    const double radii = a->radius + b->radius, depth = -gap->separation, overlap = radii + depth,
                 over = depth / (DEM__DEEP * radii);
    const double x = dem__clamp(over, 0.0, 1.0), s = x * x * (3.0 - 2.0 * x),
                 slope = 6.0 * x * (1.0 - x) / (DEM__DEEP * radii);
    if (!(depth > 0.0)) return n;
    for (int k = 0; k < n; k++) out[k].weight *= 1.0 - s;
    const dem__farthest_part of_a = dem__find_part(a, pa, dem__scale(-1.0, gap->normal)),
                             of_b = dem__find_part(b, pb, gap->normal);
    dem__convex_point *point = &out[n];
    const double force = dem__force_at(overlap, power), energy = sums->energy, part = s * force,
                 spring = part + slope * (overlap * force - energy) / power;
    point->key = 2 * DEM_CORNERS_MAX + 5 * DEM_EDGES_MAX * DEM_EDGES_MAX;
    dem__count_point(point, s, -overlap);
    point->count = 1.0, point->normal = gap->normal;
    point->at = dem__meeting_point(&of_a, &of_b);
    dem__scale_shared(sums, 1.0 - s);
    sums->energy += part * overlap, sums->parts += part, sums->whole += s, sums->springs += spring;
    dem__add_shared(&sums->normal, &sums->on_i, part, point);
    dem__add_shared(&sums->pull, &sums->pull_on_i, spring, point);
    return n + 1;
}
