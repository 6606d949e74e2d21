/* Pairs of compounds. All points of two bodies, or of a body and a wall, share the law of one pair, whatever parts they
   belong to: a floor drawn by three parts is one face. Reads pairs and bodies; chains pairs of the same two bodies, and
   writes their points. Promises: one thread finds the points of two bodies, in the order of particles, so bits depend
   neither on threads nor on the order of the list. */
#pragma once
#include "pair_points.h"

/* Returns the first part of the compound of particle i, or i, or the wall -1 - i. */
DEM_INLINE int32_t dem__first_part(const dem_world *w, int32_t i) {
    return i >= 0 && dem__is_part(w, i) ? (int32_t)dem__pieces_of(w, i).first : i;
}

/* Returns whether two pairs are between the same bodies. */
DEM_INLINE int dem__same_bodies(const dem_world *w, const dem__convex_pair *p, const dem__convex_pair *q) {
    return dem__first_part(w, p->i) == dem__first_part(w, q->i) && dem__first_part(w, p->j) == dem__first_part(w, q->j);
}

/* Returns whether pair p comes before q: by bodies, then by particles. */
static inline int dem__comes_first(const dem_world *w, const dem__convex_pair *p, const dem__convex_pair *q) {
    const int32_t a[4] = {dem__first_part(w, p->i), dem__first_part(w, p->j), p->i, p->j},
                  b[4] = {dem__first_part(w, q->i), dem__first_part(w, q->j), q->i, q->j};
    for (int k = 0; k < 4; k++) {
        if (a[k] != b[k]) return a[k] < b[k];
    }
    return 0;
}

/* Merges two sorted chains of pairs. Returns the first one. */
static inline int32_t dem__merge_chains(const dem_world *w, int32_t a, int32_t b) {
    dem__convex_pair *pair = w->engine->convex.pair;
    int32_t first = -1, *end = &first;
    while (a >= 0 && b >= 0) {
        int32_t *low = dem__comes_first(w, &pair[b], &pair[a]) ? &b : &a;
        *end = *low, end = &pair[*low].next, *low = *end;
    }
    *end = a >= 0 ? a : b;
    return first;
}

/* Chains the pairs of compounds, those of two bodies next to each other, each with the first of these. */
static inline void dem__chain_pairs(dem_world *w) {
    const dem__convex_state *convex = &w->engine->convex;
    int32_t chain[32], all = -1; /* chain k has 2^k pairs, or none */
    for (int k = 0; k < 32; k++) chain[k] = -1;
    for (int32_t q = 0; q < (int32_t)convex->pairs; q++) {
        const dem__convex_pair *p = &convex->pair[q];
        int32_t own = q;
        int k = 0;
        if (!dem__is_part(w, p->i) && !(p->j >= 0 && dem__is_part(w, p->j))) continue;
        for (; chain[k] >= 0; k++) own = dem__merge_chains(w, chain[k], own), chain[k] = -1;
        chain[k] = own;
    }
    for (int k = 0; k < 32; k++) all = chain[k] < 0 ? all : all < 0 ? chain[k] : dem__merge_chains(w, chain[k], all);
    for (int32_t q = all, lead = all; q >= 0; q = convex->pair[q].next) {
        if (!dem__same_bodies(w, &convex->pair[q], &convex->pair[lead])) lead = q;
        convex->pair[q].lead = lead;
    }
}

/* Returns the next pair of the same two bodies, or NULL. */
DEM_INLINE dem__convex_pair *dem__next_of_bodies(const dem_world *w, const dem__convex_pair *p) {
    dem__convex_pair *next = p->next < 0 ? NULL : &w->engine->convex.pair[p->next];
    return next && next->lead == p->lead ? next : NULL;
}

/* Returns the vector from the centre of a compound to its part i, which has been placed; 0 for other particles and for
   walls. */
static inline dem_vec dem__arm_of_part(const dem_world *w, int32_t i) {
    if (i < 0 || !dem__is_part(w, i)) return dem_vec3(0.0, 0.0, 0.0);
    const dem__placed *place = &w->engine->convex.place[i];
    const dem_vec own = dem__to_body(w->engine->convex.part[i], w->engine->bodies.offset[i]);
    return dem__plus(dem__plus(dem__scale(own.x, place->axis[0]), own.y, place->axis[1]), own.z, place->axis[2]);
}

/* The points of two bodies. Their origin is the centre of the first one. */
typedef struct dem__bodies_points {
    dem__convex_pair *lead;   /* the first pair */
    dem__convex_pair *touch;  /* the first one with points, or NULL */
    dem__convex_point *point; /* [count] */
    int count, deep;          /* deep: number of pairs whose cores overlap */
    ptrdiff_t first;          /* of the world's points */
    dem_vec apart;            /* from the centre of the second body to that of the first */
    int may_cut;              /* whether a wall may cut a core */
} dem__bodies_points;

/* Finds the points of all pairs of two bodies, each with its own spring. Returns 0 if there is no room for them. */
static inline int dem__find_bodies_points(dem_world *w, dem__bodies_points *b, int64_t step, ptrdiff_t room,
                                          int64_t *overlaps) {
    for (dem__convex_pair *p = b->lead; p; p = dem__next_of_bodies(w, p)) {
        dem__convex_point *out = b->point + b->count;
        int may_cut = 0;
        dem_vec d = dem_vec3(0.0, 0.0, 0.0);
        p->first = (int32_t)(b->first + b->count), p->depth = 0.0;
        if (!p->is_close) continue;
        if (room - b->count - b->deep < DEM__POINTS_MAX) return 0;
        if (p->j >= 0) d = dem__apart_in(w, p, step);
        p->count = p->j >= 0 ? dem__find_pair_points(w, p, step, d, out, overlaps)
                             : dem__find_wall_points(w, p, step, out, &may_cut);
        b->may_cut |= may_cut, b->deep += p->depth > 0.0;
        if (!(p->count > 0 || p->depth > 0.0)) continue;
        const dem_vec arm = dem__arm_of_part(w, p->i);
        for (int k = 0; k < p->count; k++) out[k].at = dem__add(out[k].at, arm);
        b->count += p->count;
        if (b->touch) continue;
        b->touch = p;
        if (p->j >= 0) b->apart = dem__add(dem__sub(d, arm), dem__arm_of_part(w, p->j));
    }
    return 1;
}

/* Adds the points that push overlapping cores apart, each at the end of those of its pair. */
static inline void dem__push_bodies_apart(dem_world *w, dem__bodies_points *b, int64_t step, dem__shared *sums) {
    int added = 0;
    for (dem__convex_pair *p = b->lead; p; p = dem__next_of_bodies(w, p)) {
        p->first += added;
        if (!(p->depth > 0.0)) continue;
        const dem_vec arm = dem__arm_of_part(w, p->i);
        const int n =
            dem__push_pair_apart(w, p, arm, dem__sub(arm, dem__apart_in(w, p, step)), sums, b->point, b->count);
        if (n == b->count) continue;
        const ptrdiff_t at = p->first - b->first + p->count;
        const dem__convex_point fresh = b->point[b->count];
        memmove(b->point + at + 1, b->point + at, (size_t)(b->count - at) * sizeof fresh);
        b->point[at] = fresh;
        p->count++, b->count++, added++;
    }
}

/* Moves the torques of a pull from the centres of two bodies to those of the parts of a pair. */
static inline void dem__pull_at_parts(const dem_world *w, dem__convex_pair *p) {
    const dem_vec f = dem__first(p->pull), on_i = dem__cross(dem__arm_of_part(w, p->i), f),
                  on_j = dem__cross(dem__arm_of_part(w, p->j), f);
    for (int a = 0; a < 3; a++) p->pull[3 + a] -= dem_axis(on_i, a), p->pull[6 + a] += dem_axis(on_j, a);
}

/* Finds the points of two bodies, whose first pair is number `lead`, with their parts in the law. They are put from
   `first` on, below `limit`. Returns how much room they take, or -1 if there is not enough. */
static DEM__NOINLINE ptrdiff_t dem__points_of_bodies(dem_world *w, ptrdiff_t lead, int64_t step, ptrdiff_t first,
                                                     ptrdiff_t limit, int64_t *overlaps, int64_t *cuts) {
    dem__bodies_points b;
    dem__settled t;
    memset(&b, 0, sizeof b), memset(&t, 0, sizeof t);
    b.lead = &w->engine->convex.pair[lead], b.first = first, b.point = w->engine->convex.point + first;
    if (!dem__find_bodies_points(w, &b, step, limit - first, overlaps)) return -1;
    dem__shared sums = dem__share_points(b.point, b.count, w->engine->run.power);
    if (b.deep > 0) dem__push_bodies_apart(w, &b, step, &sums);
    if (b.count > 0) t = dem__settle(w, b.touch, b.apart, &sums);
    for (dem__convex_pair *p = b.lead; p; p = dem__next_of_bodies(w, p)) {
        dem__convex_point *own = w->engine->convex.point + p->first;
        if (!p->is_close) continue;
        const dem_vec arm = p->count > 0 ? dem__arm_of_part(w, p->i) : dem_vec3(0.0, 0.0, 0.0);
        if (p->count > 0 && !sums.are_parts) dem__set_pull(p, b.apart, t.raise, &sums), dem__pull_at_parts(w, p);
        p->count = dem__settle_points(own, p->count, &t, sums.are_parts);
        for (int k = 0; k < p->count; k++) own[k].at = dem__sub(own[k].at, arm);
        if (p->j < 0) *cuts += dem__is_cut_at(w, p, own, p->count, b.may_cut);
    }
    return b.count;
}
