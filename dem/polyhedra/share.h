/* How the points of a pair share its law: a face that lands flat has the spring and the dashpot of the pair, however many
   corners it is drawn with. Reads a pair's points and bodies; writes their parts and what the springs of the pair exert
   beyond them. Promises: springs are the gradient of a potential (of a linear law and of Hertz's); a point that begins or
   ends changes no force by a jump.

   A point has the part w = 1/n of the spring, where n is the greatest number of corners of a face of its body
   (dem_convex.springs), and l what the ends of edges leave of it (1 for a corner). With D its overlap and t = D^2, the
   energy of the pair is

       U = (k/p) sum w l D^p / N(c),     c = (sum w l t)^2 / sum w l t^2,     p = 2, Hertz 5/2.

   c is the stiffness over k if all points are as deep as each other. N is 1 up to 2, which two equal faces on each other
   have, and c/2 from 2.5 on: a tile that lies on a hundred wires is no stiffer than 2 k. Up to there nothing but the sum
   of springs acts. It must be a sum: a body tips when the load is over its edge, and if an edge were as stiff as a face,
   points about to part would have to pull for it.

   The dashpot acts on the mass that the resultant of the springs meets, with the stiffness that they have. So the
   restitution, at the point where the resultant acts, is that of the pair. */
#pragma once
#include "../motion/motion.h"
#include "walls.h"

/* Returns an overlap to the power of the energy, or of the force. square: of the overlap. */
DEM_INLINE double dem__energy_at(double square, double power) {
    return power > 2.0 ? square * sqrt(sqrt(square)) : square;
}
DEM_INLINE double dem__force_at(double square, double power) {
    return power > 2.0 ? sqrt(square * sqrt(square)) : sqrt(square);
}

/* Gives a point its part of the spring of its body. */
DEM_INLINE void dem__divide_point(dem__convex_point *p, int springs) {
    p->weight /= (double)springs, p->count /= (double)springs;
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

/* The springs of a pair together: their energy over k/p, and whether they are no more than the parts of its points in
   the law, as where only corners touch. */
typedef struct dem__springs {
    double energy;
    int are_parts;
} dem__springs;

/* Sets the parts of a pair's n points in its law, and the factors of their springs. */
static inline dem__springs dem__share_points(dem__convex_point *p, int n, double power) {
    const double half = 0.5 * power;
    /* head: t of the crossing to which an end belongs */
    double most = DBL_MIN, first = 0.0, second = 0.0, sum = 0.0, head = 1.0;
    dem__springs of = {0.0, 1};
    for (int k = 0; k < n; k++) most = p[k].gap * p[k].gap > most ? p[k].gap * p[k].gap : most;
    for (int k = 0; k < n; k++) {
        const double t = p[k].gap * p[k].gap / most;
        first += p[k].count * t, second += p[k].count * t * t, sum += p[k].count * dem__energy_at(t, power);
        of.are_parts &= p[k].weight == p[k].count;
    }
    if (n == 0) return of;
    const dem__division divided = dem__divide(first * first / second);
    of.energy = sum / divided.by * dem__energy_at(most, power), of.are_parts &= divided.by == 1.0;
    const double lost = sum * divided.slope / (divided.by * divided.by), per = first / second;
    for (int k = 0; k < n && !of.are_parts; k++) {
        const double l = p[k].count, w = p[k].weight, own = p[k].gap * p[k].gap / most, t = l > 0.0 ? head = own : head;
        double spring = dem__energy_at(t, power) / t * (w + (half - 1.0) * l) / divided.by;
        if (lost > 0.0) spring -= lost * per * (2.0 * w - per * t * (w + l));
        p[k].spring = power > 2.0 ? spring / (half * sqrt(sqrt(own))) : spring;
        p[k].weight = l / divided.by;
    }
    for (int k = 0; k < n && of.are_parts; k++) p[k].spring = p[k].weight;
    return of;
}

/* Sums of a pair: its energy over k/p; divided by the stiffness, the forces of the law by the parts, and those of the
   springs. */
typedef struct dem__shared {
    double energy, parts, springs, whole; /* whole: sum of the parts */
    dem_vec normal, on_i, on_j;           /* the forces by the parts, and their moments about the centres */
} dem__shared;

/* Returns how much faster a force of 1 N with a moment about the centre of particle i moves i where it acts, because i
   turns [1/kg]. */
DEM_INLINE double dem__per_turning(const dem_world *w, ptrdiff_t i, dem_vec moment) {
    const dem_convex *s = dem__shape_of(w, i);
    if (!s || dem__is_fixed(w, i)) return 0.0;
    const dem_vec t = dem__into_core(&w->engine->convex.place[i], moment);
    const double sum = t.x * t.x / s->moment[0] + t.y * t.y / s->moment[1] + t.z * t.z / s->moment[2];
    return s->volume * sum / w->particle[i].mass;
}

/* Returns the factor of the closing speed with which the pair's dashpot becomes that of the resultant. The law's own
   dashpot is that of the whole masses and of the pair's spring. */
static inline double dem__damping_of(const dem_world *w, const dem__convex_pair *pair, const dem__shared *s,
                                     double power) {
    const double length = dem__length(s->normal), least = 0.5 * s->parts; /* normals may face each other */
    const double per = 1.0 / (length > least ? length : least), depth = s->energy / s->springs;
    double whole = dem__is_fixed(w, pair->i) ? 0.0 : 1.0 / w->particle[pair->i].mass,
           turning = dem__per_turning(w, pair->i, dem__scale(per, s->on_i));
    if (pair->j >= 0) {
        whole += dem__is_fixed(w, pair->j) ? 0.0 : 1.0 / w->particle[pair->j].mass;
        turning += dem__per_turning(w, pair->j, dem__scale(per, s->on_j));
    }
    const double stiffness = s->energy / dem__energy_at(depth * depth, power); /* over the stiffness of the pair */
    return whole > 0.0 ? sqrt(stiffness * whole / (whole + turning)) / s->whole : 1.0;
}

/* Sets the pull of a pair and each point's part in it, and removes ends. raise: factor of the parts, so that friction,
   which they limit, sees the whole force. Returns how many points are left. */
static DEM__NOINLINE int dem__set_pull(dem__convex_pair *pair, dem_vec apart, double power, double parts, double raise,
                                       dem__convex_point *p, int n) {
    int kept = 0;
    for (int a = 0; a < 9; a++) pair->pull[a] = 0.0;
    for (int k = 0; k < n; k++) {
        const double part = raise * p[k].weight,
                     more = (p[k].spring - part) * dem__force_at(p[k].gap * p[k].gap, power);
        const dem_vec f = dem__scale(more, p[k].normal), on_i = dem__cross(p[k].at, f),
                      on_j = dem__cross(dem__add(p[k].at, apart), f);
        for (int a = 0; a < 3; a++) {
            pair->pull[a] += dem_axis(f, a);
            pair->pull[3 + a] += dem_axis(on_i, a), pair->pull[6 + a] -= dem_axis(on_j, a);
        }
        p[k].pull = p[k].weight / parts, p[k].weight = part;
        if (p[k].count > 0.0) p[kept++] = p[k];
    }
    return kept;
}

/* Completes the n points of a pair. apart: from the centre of j to that of i. Returns how many points are left. */
static inline int dem__finish_points(const dem_world *w, dem__convex_pair *pair, dem_vec apart, dem__springs of,
                                     dem__convex_point *p, int n) {
    const double power = w->engine->run.power;
    dem__shared s;
    memset(&s, 0, sizeof s);
    s.energy = of.energy;
    for (int k = 0; k < n; k++) {
        const double force = dem__force_at(p[k].gap * p[k].gap, power), part = p[k].weight * force;
        s.parts += part, s.springs += p[k].spring * force, s.whole += p[k].weight;
        s.normal = dem__plus(s.normal, part, p[k].normal);
        s.on_i = dem__plus(s.on_i, part, dem__cross(p[k].at, p[k].normal));
        if (pair->j >= 0) s.on_j = dem__plus(s.on_j, part, dem__cross(dem__add(p[k].at, apart), p[k].normal));
        p[k].pull = 0.0;
    }
    if (n == 0) return 0;
    const double raise = of.are_parts ? 1.0 : dem__clamp(s.springs / s.parts, 0.25, 4.0);
    s.springs = raise * s.parts, s.whole *= raise;
    const double damping = dem__damping_of(w, pair, &s, power);
    for (int k = 0; k < n; k++) p[k].damping = damping;
    return of.are_parts ? n : dem__set_pull(pair, apart, power, s.parts, raise, p, n);
}
