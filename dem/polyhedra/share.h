/* How the points of a pair share its law: a face that lies on a face or on a wall is one contact, whatever the number of
   its corners. Reads a pair's points and bodies; writes their parts and what the springs of the pair exert beyond them.
   Promises: springs are the gradient of a potential (of a linear law); a point that begins or ends changes no force by a
   jump; one point alone has the whole law.

   With E the energy of a corner or crossing by itself and t = 2 E/k of a linear law, the pair has the mean energy

       U = sum E t^q / sum t^q,

   so the deepest points decide, and n points of the same depth have the stiffness of one. The part t^q/sum t^q of a point
   is that which it has in the dashpot and in friction as well. The gradient of U also has the change of the parts: a
   point that is less deep than the mean is pulled deeper. This comes on top as the pair's pull, whose force is 0 where
   normals are parallel: it is a moment.

   The dashpot acts on the mass that the resultant of the springs meets. So the restitution, at the point where the
   resultant acts, is that of the pair. */
#pragma once
#include "walls.h"

#define DEM__SHARE_POWER 2.0 /* q: of t in the part of a point; 1 would do, but with a pull that is deeper */

/* Returns E of a point over half its stiffness, from t. power: of the overlap in E. */
DEM_INLINE double dem__law_energy(double t, double power) { return power > 2.0 ? t * sqrt(sqrt(t)) : t; }

/* Returns how much two points are one contact: those on facets of a mesh 1 where normals agree to 26 degrees, 0 from 60
   degrees on; others, whose normals turn with the motion, 1. */
DEM_INLINE double dem__is_one_face(const dem__convex_point *p, const dem__convex_point *q) {
    if (!(p->on_facet && q->on_facet)) return 1.0;
    const double t = dem__clamp((dem__dot(p->normal, q->normal) - 0.5) / (DEM__SMOOTH - 0.5), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/* Returns whether all points of a pair share. */
static inline int dem__is_one_contact(const dem__convex_point *p, int n) {
    const dem__convex_point *first = NULL;
    int alike = 1;
    for (int k = 0; k < n; k++) {
        if (!p[k].on_facet) continue;
        if (!first) first = &p[k];
        alike &= dem__dot(p[k].normal, first->normal) > 0.975; /* cosine of half the 26 degrees */
    }
    return alike;
}

/* Sets the parts of a pair's n points in its law and its springs. Returns the energy of the pair over its stiffness
   [m2]. A crossing is counted at its first point, whose weight is above 0; those of its ends have weights below. */
static inline double dem__share_points(dem__convex_point *p, int n, double power) {
    const double q = DEM__SHARE_POWER;
    const int is_one = dem__is_one_contact(p, n);
    double sum[DEM__POINTS_MAX], mean[DEM__POINTS_MAX], most = 0.0, energy = 0.0;
    for (int k = 0; k < n; k++) most = p[k].energy > most ? p[k].energy : most;
    most += DBL_MIN;
    for (int k = 0; k < n; k++) p[k].energy = (p[k].energy + DBL_MIN) / most; /* from here on t over the greatest */
    for (int k = 0; k < n; k++) {
        sum[k] = k > 0 && is_one ? sum[0] : 0.0;
        for (int m = 0; m < n && (k == 0 || !is_one); m++) {
            if (p[m].weight > 0.0) sum[k] += (is_one ? 1.0 : dem__is_one_face(&p[k], &p[m])) * p[m].energy * p[m].energy;
        }
    }
    for (int k = 0; k < n; k++) {
        mean[k] = k > 0 && is_one ? mean[0] : 0.0;
        for (int m = 0; m < n && (k == 0 || !is_one); m++) {
            if (!(p[m].weight > 0.0)) continue;
            const double part = p[m].energy * p[m].energy / sum[m];
            mean[k] += (is_one ? 1.0 : dem__is_one_face(&p[k], &p[m])) * dem__law_energy(p[m].energy, power) * part / sum[m];
        }
    }
    for (int k = 0; k < n; k++) {
        const double t = p[k].energy, own = dem__law_energy(t, power), part = t * t / sum[k],
                     change = own > 0.0 ? 2.0 * q / power * (part - t * t * mean[k] / own) : 0.0;
        if (p[k].weight > 0.0) energy += 0.5 * part * t * most;
        p[k].spring = p[k].weight * (part + change);
        p[k].weight *= part;
    }
    return energy;
}

/* Sums of the springs of a pair over the stiffness. */
typedef struct dem__shared {
    double parts, positive, springs; /* forces by the parts in the law, by those above 0, and of the springs */
    dem_vec normal, on_i, on_j; /* the forces by the parts, and their moments about the centres */
} dem__shared;

/* Returns the force of a point's spring over its stiffness. */
DEM_INLINE double dem__spring_at(const dem__convex_point *p, double power) {
    return power > 2.0 ? -p->gap * sqrt(-p->gap) : -p->gap;
}

/* Returns how much a force of 1 N with a moment about the centre of particle i moves i where it acts [1/kg]. */
DEM_INLINE double dem__per_mass_at(const dem_world *w, ptrdiff_t i, dem_vec moment) {
    const dem_convex *s = dem__shape_of(w, i);
    double sum = 1.0;
    if (dem__is_fixed(w, i)) return 0.0;
    if (s) {
        const dem_vec t = dem__into_core(&w->engine->convex.place[i], moment);
        sum += s->volume * (t.x * t.x / s->moment[0] + t.y * t.y / s->moment[1] + t.z * t.z / s->moment[2]);
    }
    return sum / w->particle[i].mass;
}

/* Returns the factor of the closing speed that makes the pair's dashpot that of the resultant: the law's own is that of
   the whole masses. */
static inline double dem__damping_of(const dem_world *w, const dem__convex_pair *pair, const dem__shared *s) {
    const dem_vec none = dem_vec3(0.0, 0.0, 0.0);
    const double length = dem__length(s->normal), least = 0.5 * s->positive; /* normals may face each other */
    const double per = 1.0 / (length > least ? length : least);
    double whole = dem__per_mass_at(w, pair->i, none), here = dem__per_mass_at(w, pair->i, dem__scale(per, s->on_i));
    if (pair->j >= 0) {
        whole += dem__per_mass_at(w, pair->j, none);
        here += dem__per_mass_at(w, pair->j, dem__scale(per, s->on_j));
    }
    return here > 0.0 ? sqrt(whole / here) : 1.0;
}

/* Completes the points of a pair: their damping, and the pull. apart: from the centre of j to that of i. The parts are
   raised so that the friction, which they limit, counts on the whole force. */
static inline void dem__finish_points(const dem_world *w, dem__convex_pair *pair, dem_vec apart, dem__convex_point *p,
                                      int n) {
    const double power = w->engine->run.power;
    dem__shared s;
    memset(&s, 0, sizeof s);
    for (int k = 0; k < n; k++) {
        const double force = dem__spring_at(&p[k], power), part = p[k].weight * force;
        s.parts += part, s.positive += part > 0.0 ? part : 0.0, s.springs += p[k].spring * force;
        s.normal = dem__plus(s.normal, part, p[k].normal);
        s.on_i = dem__plus(s.on_i, part, dem__cross(p[k].at, p[k].normal));
        s.on_j = dem__plus(s.on_j, part, dem__cross(dem__add(p[k].at, apart), p[k].normal));
    }
    const double raise = s.parts > 0.0 ? dem__clamp(s.springs / s.parts, 0.25, 4.0) : 1.0,
                 damping = dem__damping_of(w, pair, &s) / raise;
    for (int a = 0; a < 9; a++) pair->pull[a] = 0.0;
    for (int k = 0; k < n; k++) {
        p[k].damping = damping, p[k].pull = n > 1 && p[k].weight > 0.0 ? p[k].weight / s.positive : 0.0;
        p[k].weight *= raise;
        const double more = (p[k].spring - p[k].weight) * dem__spring_at(&p[k], power);
        const dem_vec f = dem__scale(more, p[k].normal), on_i = dem__cross(p[k].at, f),
                      on_j = dem__cross(dem__add(p[k].at, apart), f);
        for (int a = 0; a < 3; a++) {
            pair->pull[a] += dem_axis(f, a);
            pair->pull[3 + a] += dem_axis(on_i, a), pair->pull[6 + a] -= dem_axis(on_j, a);
        }
    }
}
