/* The points of one pair. Reads placed bodies and walls; writes the pair and its points. Promises: they depend only on
   the pair and the step. */
#pragma once
#include "share.h"
#include "entered.h"
#include "skip.h"

/* Finds the point of a sphere at x, relative to the polyhedron's centre. Returns 1, or 0 if they do not touch; then
   only gap and normal are set. sphere_first: the sphere is a, the polyhedron b. */
static inline int dem__points_of_sphere(const dem_convex *s, const dem__placed *place, dem_vec x, double radius,
                                        int sphere_first, dem__convex_point *out) {
    dem_vec n;
    const double distance = dem__from_core(s, place, x, HUGE_VAL, &n);
    out->gap = distance - radius - s->radius;
    out->normal = dem__scale(sphere_first ? 1.0 : -1.0, n);
    if (!(out->gap < 0.0)) return 0;
    out->key = 0;
    dem__count_point(out, 1.0, out->gap);
    out->at = sphere_first ? dem_vec3(0.0, 0.0, 0.0) : dem__plus(x, -distance, n); /* from the centre of a */
    return 1;
}

/* Returns the vector from the centre of particle j of a pair to that of i at a step. */
static inline dem_vec dem__apart_in(const dem_world *w, const dem__convex_pair *p, int64_t step) {
    const dem__convex_state *convex = &w->engine->convex;
    const dem_vec xi =
        dem__shape_of(w, p->i) ? convex->place[p->i].x : dem__at(w, p->i, dem__flown_until(w, p->i, step));
    const dem_vec xj =
        dem__shape_of(w, p->j) ? convex->place[p->j].x : dem__at(w, p->j, dem__flown_until(w, p->j, step));
    return dem__nearest_image(w, dem__sub(xi, xj));
}

/* Finds the points of two particles that are d apart, and how deep their cores overlap; `at` is relative to the centre
   of i. Returns how many. */
static inline int dem__find_pair_points(dem_world *w, dem__convex_pair *p, int64_t step, dem_vec d,
                                        dem__convex_point *out, int64_t *overlaps) {
    const dem_convex *a = dem__shape_of(w, p->i), *b = dem__shape_of(w, p->j);
    const dem__convex_state *convex = &w->engine->convex;
    const dem_particle *particle = w->particle;
    const double reach = particle[p->i].radius + particle[p->j].radius;
    p->depth = 0.0;
    if (!(dem__dot(d, d) < reach * reach)) return 0;
    dem__placed pa = convex->place[p->i], pb = convex->place[p->j];
    pa.x = pb.x = dem_vec3(0.0, 0.0, 0.0);
    if (!a || !b) {
        const double radius = particle[a ? p->j : p->i].radius;
        const int n = a ? dem__points_of_sphere(a, &pa, dem__scale(-1.0, d), radius, 0, out)
                        : dem__points_of_sphere(b, &pb, d, radius, 1, out);
        *overlaps += n > 0 && out->gap < -(radius + (a ? a : b)->radius); /* the sphere's centre is in the core */
        if (n == 0) dem__skip_pair(w, p, step, d, out->gap, out->normal);
        return n;
    }
    const double radii = a->radius + b->radius, good = DEM__GOOD_AXIS * radii;
    pb.x = dem__scale(-1.0, d);
    /* A direction only decides which features are tested. That of an earlier step serves as long as the cores are
       nearly as far apart along it. */
    double apart = dem__apart_along(a, &pa, b, &pb, p->axis);
    if (!(apart > good) && a->is_box && b->is_box) apart = dem__part_boxes(a, &pa, b, &pb, good, &p->axis);
    dem__gap_of_cores gap;
    gap.overlap = 0;
    if (!(apart > good)) {
        dem__find_gap(a, &pa, b, &pb, DEM__WINDOW * radii, &p->cache, &gap);
        *overlaps += gap.overlap;
        apart = gap.separation, p->axis = gap.normal;
        p->depth = gap.overlap && apart < 0.0 ? -apart : 0.0;
    }
    int n = apart < DEM__WINDOW * radii ? dem__find_points(a, &pa, b, &pb, p->axis, out) : 0;
    n -= gap.overlap && n == DEM__POINTS_MAX; /* there is one more then */
    if (n == 0 && !(p->depth > 0.0)) dem__skip_pair(w, p, step, d, apart - radii, p->axis);
    return n;
}

/* Adds to n points the one that pushes the overlapping cores of a pair apart. xi, xj: the centres, relative to the
   points' origin. Returns the number of points. */
static DEM__NOINLINE int dem__push_pair_apart(const dem_world *w, const dem__convex_pair *p, dem_vec xi, dem_vec xj,
                                              dem__shared *sums, dem__convex_point *out, int n) {
    dem__placed pa = w->engine->convex.place[p->i], pb = w->engine->convex.place[p->j];
    dem__gap_of_cores gap;
    memset(&gap, 0, sizeof gap);
    pa.x = xi, pb.x = xj;
    gap.overlap = 1, gap.separation = -p->depth, gap.normal = p->axis;
    return dem__push_apart(dem__shape_of(w, p->i), &pa, dem__shape_of(w, p->j), &pb, &gap, w->engine->run.power, sums,
                           out, n);
}

/* Finds the points of two particles, with their parts in the law. Returns how many. */
static inline int dem__points_of_pair(dem_world *w, dem__convex_pair *p, int64_t step, dem__convex_point *out,
                                      int64_t *overlaps) {
    const dem_vec d = dem__apart_in(w, p, step);
    int n = dem__find_pair_points(w, p, step, d, out, overlaps);
    dem__shared sums = dem__share_points(out, n, w->engine->run.power);
    if (p->depth > 0.0) n = dem__push_pair_apart(w, p, dem_vec3(0.0, 0.0, 0.0), dem__scale(-1.0, d), &sums, out, n);
    return dem__finish_points(w, p, d, &sums, out, n);
}

/* Finds the points of a particle at a wall, both at the end of the step. Returns how many. may_cut: whether the wall
   may cut the core. */
static inline int dem__find_wall_points(const dem_world *w, dem__convex_pair *p, int64_t step, dem__convex_point *out,
                                        int *may_cut) {
    const dem_wall *wall = &w->wall[-1 - p->j];
    const dem_convex *s = dem__shape_of(w, p->i);
    const dem__placed *place = &w->engine->convex.place[p->i];
    const int n = dem__touch_with_polyhedron(wall, s, place, out, may_cut);
    p->depth = 0.0;
    if (n == 0 && dem__may_skip_wall(w, p->i))
        dem__skip_wall(w, p, step, place->x, dem__clear_of_wall(wall, s, place), s->reach);
    return n;
}
/* Returns whether a wall cuts the core of a particle with these n points. */
static inline int dem__is_cut_at(const dem_world *w, const dem__convex_pair *p, const dem__convex_point *out, int n,
                                 int may_cut) {
    const dem_convex *s = dem__shape_of(w, p->i);
    int is_cut = 0;
    for (int k = 0; k < n; k++) is_cut |= out[k].gap < -s->radius;
    return is_cut || (may_cut && dem__core_passes(&w->wall[-1 - p->j], s, &w->engine->convex.place[p->i]));
}
/* Finds these points with their parts in the law. Returns how many. cuts: 1 more if the wall cuts the core. */
static inline int dem__points_at_wall(const dem_world *w, dem__convex_pair *p, int64_t step, dem__convex_point *out,
                                      int64_t *cuts) {
    int may_cut, n = dem__find_wall_points(w, p, step, out, &may_cut);
    dem__shared sums = dem__share_points(out, n, w->engine->run.power);
    n = dem__finish_points(w, p, dem_vec3(0.0, 0.0, 0.0), &sums, out, n);
    *cuts += dem__is_cut_at(w, p, out, n, may_cut);
    return n;
}
