/* Where a sphere touches a mesh. Reads a wall and its tree; owns nothing. Promises: the same bits with a cached face as
   by a search. */
#pragma once
#include "../base/triangles.h"
#include "kind.h"

/* The face on which a contact with a mesh rests. It is the only place touched as long as the centre is within `slack`
   of `at`, and a contact opens by less than that in a step. */
typedef struct dem__face_cache {
    dem_vec at;   /* in the wall's own frame */
    double slack; /* [m]; 0: search */
    int32_t face;
} dem__face_cache;
#define DEM__SMOOTH 0.9 /* cosine of 26 degrees, up to which facets are one surface: a drum with 16 sides counts as
                           round */

/* Returns the vector from the plane of a triangle to p. distance: its length. All triangles in one plane give the same
   vector. */
DEM_INLINE dem_vec dem__above_face(const dem__tree *t, int32_t k, dem_vec p, double *distance) {
    const double up = dem__dot(dem__sub(p, t->vertex[t->corner[3 * k]]), t->normal[k]);
    *distance = fabs(up);
    return dem__scale(up, t->normal[k]);
}

/* Returns the vector from the nearest point of a triangle to p (Ericson 2005, Real-Time Collision Detection, 5.1.5).
   distance: its length; inside: whether the point is not on an edge or a corner. */
static inline dem_vec dem__from_triangle(const dem__tree *t, int32_t k, dem_vec p, double *distance, int *inside) {
    const dem_vec a = t->vertex[t->corner[3 * k]], b = t->vertex[t->corner[3 * k + 1]],
                  c = t->vertex[t->corner[3 * k + 2]];
    const dem_vec ab = dem__sub(b, a), ac = dem__sub(c, a), ap = dem__sub(p, a), bp = dem__sub(p, b),
                  cp = dem__sub(p, c);
    const double a1 = dem__dot(ab, ap), a2 = dem__dot(ac, ap), b1 = dem__dot(ab, bp), b2 = dem__dot(ac, bp),
                 c1 = dem__dot(ab, cp), c2 = dem__dot(ac, cp);
    const double to_ab = a1 * b2 - b1 * a2, to_ac = c1 * a2 - a1 * c2, to_bc = b1 * c2 - c1 * b2;
    dem_vec v;
    *inside = 0;
    if (a1 <= 0.0 && a2 <= 0.0) v = ap;
    else if (b1 >= 0.0 && b2 <= b1) v = bp;
    else if (c2 >= 0.0 && c1 <= c2) v = cp;
    else if (to_ab <= 0.0 && a1 >= 0.0 && b1 <= 0.0) v = dem__sub(ap, dem__scale(a1 / (a1 - b1), ab));
    else if (to_ac <= 0.0 && a2 >= 0.0 && c2 <= 0.0) v = dem__sub(ap, dem__scale(a2 / (a2 - c2), ac));
    else if (to_bc <= 0.0 && b2 >= b1 && c1 >= c2)
        v = dem__sub(bp, dem__scale((b2 - b1) / ((b2 - b1) + (c1 - c2)), dem__sub(c, b)));
    else {
        *inside = 1;
        return dem__above_face(t, k, p, distance);
    }
    *distance = dem__length(v);
    return v;
}

/* Returns whether p is `reach` or more away from a node's box. */
DEM_INLINE int dem__is_far(const dem__node *b, dem_vec p, double reach) {
    const double x = p.x - dem__clamp(p.x, b->low[0], b->high[0]), y = p.y - dem__clamp(p.y, b->low[1], b->high[1]),
                 z = p.z - dem__clamp(p.z, b->low[2], b->high[2]);
    return !(x * x + y * y + z * z < reach * reach);
}

/* Returns whether a nearer place hides another one, because a surface is touched only once. It does so if their normals
   agree to 26 degrees, or if the farther place does not rise over the nearer one's tangent plane, as edges and corners
   of a touched face do not. */
DEM_INLINE int dem__is_hidden(const dem__touch *far_one, const dem__touch *near_one, double radius) {
    const double flat = (1.0 - 1e-9) * (radius + near_one->gap) / (radius + far_one->gap);
    return dem__dot(far_one->normal, near_one->normal) > (flat < DEM__SMOOTH ? flat : DEM__SMOOTH);
}

/* Returns whether p is certainly `far_off` or more away from the plane of a triangle. */
DEM_INLINE int dem__is_off_plane(const dem__tree *t, int32_t k, dem_vec p, double far_off) {
    const dem_vec d = dem__sub(p, t->vertex[t->corner[3 * k]]);
    return fabs(dem__dot(d, t->normal[k])) - 1e-12 * (fabs(d.x) + fabs(d.y) + fabs(d.z)) > far_off;
}

static inline void dem__meet_triangle(const dem__tree *t, int32_t k, dem_vec p, double radius, dem__touch *touch) {
    double distance;
    int inside;
    const dem_vec v = dem__from_triangle(t, k, p, &distance, &inside);
    touch->gap = distance - radius;
    touch->normal = distance > 0.0 ? dem__scale(1.0 / distance, v) : t->normal[k];
    touch->curvature = 0.0;
    touch->face = inside ? k : -1;
}

/* Finds the nearest place of a mesh, if its gap is below `limit`, and the places with a gap below `deep` that no nearer
   one hides: at most DEM__TOUCHES, nearest first. Returns how many. least: the smallest gap, or limit. */
static inline int dem__touch_mesh(const dem_wall *w, dem_vec d, double radius, double deep, double limit,
                                  dem__touch *out, double *least) {
    const dem__tree *t = w->tree;
    const dem_vec p = dem__to_frame(w, d);
    dem__touch here;
    int n = 0;
    *least = limit;
    for (int32_t b = 0; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, p, radius + *least)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) {
            if (dem__is_off_plane(t, k, p, radius + *least)) continue;
            dem__meet_triangle(t, k, p, radius, &here);
            if (here.gap < *least) *least = here.gap, out[0] = here, n = 1;
        }
    }
    for (int32_t b = *least < deep ? 0 : t->nodes; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, p, radius + deep)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) {
            int at = 0, kept;
            if (dem__is_off_plane(t, k, p, radius + deep)) continue;
            dem__meet_triangle(t, k, p, radius, &here);
            if (!(here.gap < deep)) continue;
            while (at < n && out[at].gap <= here.gap && !dem__is_hidden(&here, &out[at], radius)) at++;
            if (at == DEM__TOUCHES || (at < n && out[at].gap <= here.gap)) continue;
            kept = at;
            for (int q = at; q < n; q++) { /* remove those that it hides */
                if (!dem__is_hidden(&out[q], &here, radius)) out[kept++] = out[q];
            }
            n = kept < DEM__TOUCHES ? kept + 1 : DEM__TOUCHES;
            for (int q = n - 1; q > at; q--) out[q] = out[q - 1];
            out[at] = here;
        }
    }
    for (int q = 0; q < n; q++) {
        out[q].normal = dem__from_frame(w, out[q].normal);
        out[q].element = q;
    }
    return n;
}

/* Returns how far q, a point of the plane of triangle k, is inside its edges [m]; < 0 outside. */
static inline double dem__inside_edges(const dem__tree *t, int32_t k, dem_vec q) {
    double least = HUGE_VAL;
    for (int e = 0; e < 3; e++) {
        const dem_vec u = t->vertex[t->corner[3 * k + e]], v = t->vertex[t->corner[3 * k + (e + 1) % 3]],
                      along = dem__sub(v, u);
        const double in = dem__dot(dem__sub(q, u), dem__cross(t->normal[k], along)) / dem__length(along);
        least = in < least ? in : least;
    }
    return least;
}

/* Computes the face cache of a sphere whose only touch is on a face. A triangle that rises above the plane of the face
   can be touched, or become the nearest, after half its gap. The face hides one that does not rise; that becomes the
   nearest only where the centre leaves the face for it. */
static inline dem__face_cache dem__find_face_cache(const dem_wall *w, dem_vec d, double radius,
                                                   const dem__touch *touch) {
    const dem__tree *t = w->tree;
    const int32_t face = touch->face;
    dem__face_cache f;
    double height;
    f.at = dem__to_frame(w, d), f.slack = 0.0, f.face = face;
    if (face < 0 || !(touch->gap <= 0.0)) return f;
    const dem_vec up = dem__above_face(t, face, f.at, &height), a = t->vertex[t->corner[3 * face]];
    const double inside = dem__inside_edges(t, face, dem__sub(f.at, up));
    const double above = height - 0.1 * radius; /* near the plane of the face, it does not hide others */
    double slack = 0.25 * radius < inside ? 0.25 * radius : inside;
    slack = above < slack ? above : slack;
    if (!(slack > 0.0)) return f;
    const dem_vec out = dem__scale(1.0 / height, up);
    for (int32_t b = 0; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, f.at, radius + 2.0 * slack)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) {
            double distance, rise = 0.0;
            int inner;
            if (k == face) continue;
            dem__from_triangle(t, k, f.at, &distance, &inner);
            for (int c = 0; c < 3; c++) {
                const double corner = dem__dot(dem__sub(t->vertex[t->corner[3 * k + c]], a), out);
                rise = corner > rise ? corner : rise;
            }
            const double aside = distance * distance - height * height, /* dem__is_hidden has a tolerance of 1e-9 */
                reach = rise > 5e-10 * height ? 0.5 * (distance - radius) : sqrt(aside > 0.0 ? aside : 0.0);
            slack = reach < slack ? reach : slack;
        }
    }
    f.slack = slack > 0.0 ? 0.999 * slack : 0.0;
    return f;
}

/* Computes the touch of a sphere that is still within its face cache. Returns 0 if a search is needed. opens: the most
   that a contact opens in a step [m]. */
DEM_INLINE int dem__face_cache_holds(const dem_wall *w, const dem__face_cache *f, dem_vec d, double radius,
                                     double opens, dem__touch *out) {
    const dem_vec p = dem__to_frame(w, d), moved = dem__sub(p, f->at);
    double distance;
    if (!(f->slack > opens && dem__dot(moved, moved) < f->slack * f->slack)) return 0;
    const dem_vec v = dem__above_face(w->tree, f->face, p, &distance);
    out->gap = distance - radius;
    out->normal = dem__from_frame(w, dem__scale(1.0 / distance, v));
    return 1;
}
