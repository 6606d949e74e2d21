/* How the points of a pair share its law: a face that lands flat has the spring and the dashpot of the pair, however
   many corners it is drawn with. Reads a pair's points and bodies; writes their parts and what the springs of the pair
   exert beyond them. Promises: springs are the gradient of a potential (of a linear law and of Hertz's); a point that
   begins or ends changes no force by a jump.

   A point has the part w = 1/n of the spring, where n is the greatest number of corners of a face of its body
   (dem_convex.springs), and l what the ends of edges leave of it (1 for a corner). With D its overlap and t = D^2, the
   energy of the pair is

       U = (k/p) sum w l D^p / N(c),     c = (sum w l t)^2 / sum w l t^2,     p = 2, Hertz 5/2.

   c is the stiffness over k if all points are as deep as each other. N is 1 up to 2, which two equal faces on each
   other have, and c/2 from 2.5 on: a tile that lies on a hundred wires is no stiffer than 2 k. Up to there nothing but
   the sum of springs acts. It must be a sum: a body tips when the load is over its edge, and if an edge were as stiff
   as a face, points about to part would have to pull for it.

   The dashpot acts on the mass that the resultant of the springs meets, with the stiffness that they have. So the
   restitution, at the point where the resultant acts, is that of the pair. */
#pragma once
#include "../motion/motion.h"
#include "walls.h"

/* Returns the force over the stiffness of an overlap; times the overlap it is the energy over k/p. */
DEM_INLINE double dem__force_at(double overlap, double power) {
    return power > 2.0 ? overlap * sqrt(overlap) : overlap;
}

/* The number by which the springs of a pair's points are divided, and its slope, from c: 1 up to 2, c/2 from 2.5 on. */
typedef struct dem__division {
    double by, slope;
} dem__division;
DEM_INLINE dem__division dem__divide(double c) {
    const double from = 2.0, to = 2.5, x = dem__clamp((c - from) / (to - from), 0.0, 1.0);
    dem__division d;
    d.by = c < to ? 1.0 + 0.25 * x * x * (2.0 - x) : 0.5 * c;
    d.slope = c < to ? 0.5 * x * (4.0 - 3.0 * x) : 0.5;
    return d;
}

/* Sums of a pair: its energy over k/p; over the stiffness the forces by the parts of its points in the law, and of its
   springs, and their moments about the centre of i. */
typedef struct dem__shared {
    double energy, parts, springs, whole; /* whole: sum of the parts */
    dem_vec normal, on_i, pull, pull_on_i;
    int are_parts; /* whether the springs are no more than the parts, as where only corners touch */
} dem__shared;

/* Adds a force at a point to one of the sums, with its moment. */
DEM_INLINE void dem__add_shared(dem_vec *sum, dem_vec *moment, double force, const dem__convex_point *p) {
    const dem_vec f = dem__scale(force, p->normal);
    *sum = dem__add(*sum, f), *moment = dem__add(*moment, dem__cross(p->at, f));
}

/* Divides the springs of a pair's n points, c the number that they are and per its slope. */
static DEM__NOINLINE void dem__share_springs(dem__convex_point *p, int n, double power, double c, double per,
                                             dem__shared *s) {
    const dem__division divided = dem__divide(c);
    const double half = 0.5 * power, by = 1.0 / divided.by, lost = s->energy * divided.slope * by * by * per;
    double head = 1.0; /* overlap of an end's crossing */
    s->are_parts = 0, s->springs = 0.0, s->pull = s->pull_on_i = dem_vec3(0.0, 0.0, 0.0);
    for (int k = 0; k < n; k++) {
        const double l = p[k].count, w = p[k].weight, own = fabs(p[k].gap), d = l > 0.0 ? head = own : head;
        double spring = (power > 2.0 ? sqrt(d) : 1.0) * (w + (half - 1.0) * l) * by;
        if (lost > 0.0) spring -= lost * (2.0 * w - per * d * d * (w + l));
        spring *= own / half;
        s->springs += spring, dem__add_shared(&s->pull, &s->pull_on_i, spring, &p[k]);
        p[k].weight = l * by;
    }
    s->energy *= by, s->parts *= by, s->whole *= by;
    s->normal = dem__scale(by, s->normal), s->on_i = dem__scale(by, s->on_i);
}

/* Sets the parts of a pair's n points in its law. Returns their sums. */
static inline dem__shared dem__share_points(dem__convex_point *p, int n, double power) {
    double first = 0.0, second = 0.0;
    dem__shared s;
    memset(&s, 0, sizeof s);
    s.are_parts = 1;
    for (int k = 0; k < n; k++) {
        const double d = fabs(p[k].gap), l = p[k].count, force = dem__force_at(d, power);
        first += l * d * d, second += l * d * d * (d * d), s.energy += l * force * d;
        s.whole += l, s.parts += l * force, s.are_parts &= p[k].weight == l;
        dem__add_shared(&s.normal, &s.on_i, l * force, &p[k]);
    }
    s.springs = s.parts;
    const double c = second > DBL_MIN ? first * first / second : 0.0, per = second > DBL_MIN ? first / second : 0.0;
    if (!s.are_parts || c > 2.0) dem__share_springs(p, n, power, c, per, &s);
    return s;
}

/* Returns how much faster a force of 1 N with a moment about the centre of particle i, or of its compound, moves i
   where it acts, because i turns [1/kg]. */
DEM_INLINE double dem__per_turning(const dem_world *w, ptrdiff_t i, dem_vec moment) {
    const dem_convex *s = dem__shape_of(w, i);
    if (!s || dem__is_fixed(w, i)) return 0.0;
    dem_vec t = dem__into_core(&w->engine->convex.place[i], moment);
    if (dem__is_part(w, i)) {
        const dem__rigid *r = dem__rigid_of(w, i);
        t = dem__to_lab(w->engine->convex.part[i], t); /* along the axes of the body */
        return t.x * t.x / r->moments.x + t.y * t.y / r->moments.y + t.z * t.z / r->moments.z;
    }
    const double sum = t.x * t.x / s->moment[0] + t.y * t.y / s->moment[1] + t.z * t.z / s->moment[2];
    return s->volume * sum / w->particle[i].mass;
}

/* Returns the factor of the closing speed that makes the pair's dashpot that of the resultant: the law's own is that of
   the whole masses and of the pair's spring. apart: from the centre of j to that of i. */
static inline double dem__damping_of(const dem_world *w, const dem__convex_pair *pair, dem_vec apart,
                                     const dem__shared *s, double power) {
    const double length = dem__length(s->normal), least = 0.5 * s->parts; /* normals may face each other */
    const double per = 1.0 / (length > least ? length : least), depth = s->energy / s->springs;
    double whole = dem__per_mass(w, pair->i), turning = dem__per_turning(w, pair->i, dem__scale(per, s->on_i));
    if (pair->j >= 0) {
        const dem_vec on_j = dem__add(s->on_i, dem__cross(apart, s->normal));
        whole += dem__per_mass(w, pair->j);
        turning += dem__per_turning(w, pair->j, dem__scale(per, on_j));
    }
    const double stiffness = s->springs / dem__force_at(depth, power); /* over that of the pair */
    return whole > 0.0 ? sqrt(stiffness * whole / (whole + turning)) / s->whole : 1.0;
}

/* Sets the pull of a pair, what its springs exert beyond the parts, which are raised. */
static inline void dem__set_pull(dem__convex_pair *pair, dem_vec apart, double raise, const dem__shared *s) {
    const dem_vec f = dem__plus(s->pull, -raise, s->normal), on_i = dem__plus(s->pull_on_i, -raise, s->on_i),
                  on_j = dem__add(on_i, dem__cross(apart, f));
    for (int a = 0; a < 3; a++) {
        pair->pull[a] = dem_axis(f, a);
        pair->pull[3 + a] = dem_axis(on_i, a), pair->pull[6 + a] = -dem_axis(on_j, a);
    }
}

/* What the points of a pair have in common: the parts are raised so that friction, which they limit, counts on the
   whole force; per: 1 over the sum of the parts before that. */
typedef struct dem__settled {
    double raise, per, damping;
} dem__settled;

/* Completes the sums of a pair that touches. apart: from the centre of j to that of i. */
static inline dem__settled dem__settle(const dem_world *w, dem__convex_pair *pair, dem_vec apart, dem__shared *s) {
    dem__settled t;
    t.raise = s->are_parts ? 1.0 : dem__clamp(s->springs / s->parts, 0.25, 4.0), t.per = 1.0 / s->parts;
    s->springs = t.raise * s->parts, s->whole *= t.raise;
    t.damping = dem__damping_of(w, pair, apart, s, w->engine->run.power);
    return t;
}

/* Completes n points, and removes ends. Returns the number of points left. */
static inline int dem__settle_points(dem__convex_point *p, int n, const dem__settled *t, int are_parts) {
    if (are_parts) {
        for (int k = 0; k < n; k++) p[k].damping = t->damping, p[k].pull = 0.0;
        return n;
    }
    int kept = 0;
    for (int k = 0; k < n; k++) {
        p[k].damping = t->damping, p[k].pull = p[k].weight * t->per, p[k].weight *= t->raise;
        if (p[k].count > 0.0) p[kept++] = p[k];
    }
    return kept;
}

/* Completes the n points of a pair, and removes ends. apart: from the centre of j to that of i. Returns the number of
   points left. */
static inline int dem__finish_points(const dem_world *w, dem__convex_pair *pair, dem_vec apart, dem__shared *s,
                                     dem__convex_point *p, int n) {
    if (n == 0) return 0;
    const dem__settled t = dem__settle(w, pair, apart, s);
    if (!s->are_parts) dem__set_pull(pair, apart, t.raise, s);
    return dem__settle_points(p, n, &t, s->are_parts);
}
