/* Polyhedra that a thin sheet cuts: which of their points are behind it, and how deep. A sheet has no inside, so the
   side of the body's centre counts as the front. Reads a wall, a shape and its place. Promises: overlap and normal of a
   point that passes the sheet are continuous; nothing is computed here unless a core is cut. */
#pragma once
#include "distance.h"
#include "../walls/mesh.h"

/* Returns where the line from p to q passes through triangle k of a tree, 0 .. 1; above 1: nowhere. */
static inline double dem__passes_at(const dem__tree *t, int32_t k, dem_vec p, dem_vec q) {
    const dem_vec a = t->vertex[t->corner[3 * k]], b = t->vertex[t->corner[3 * k + 1]],
                  c = t->vertex[t->corner[3 * k + 2]];
    const dem_vec u = dem__sub(q, p), pa = dem__sub(a, p), pb = dem__sub(b, p), pc = dem__sub(c, p);
    const double from = -dem__dot(t->normal[k], pa), to = -dem__dot(t->normal[k], dem__sub(a, q));
    if (!(from * to < 0.0)) return HUGE_VAL;
    const double ab = dem__dot(u, dem__cross(pa, pb)), bc = dem__dot(u, dem__cross(pb, pc)),
                 ca = dem__dot(u, dem__cross(pc, pa));
    const int passes = (ab >= 0.0 && bc >= 0.0 && ca >= 0.0) || (ab <= 0.0 && bc <= 0.0 && ca <= 0.0);
    return passes ? from / (from - to) : HUGE_VAL;
}

/* Returns a lower limit of the distance between a core and a triangle of a mesh, given in the mesh's frame [m]: the
   distance along the normal of the triangle, or of a face of the core. A value that is not above 0 says nothing,
   because they may be apart in another direction. */
static inline double dem__apart_from_triangle(const dem_convex *s, const dem__placed *core, const dem__tree *t,
                                              int32_t k, double enough) {
    const dem_vec up = t->normal[k], d = dem__sub(core->x, t->vertex[t->corner[3 * k]]);
    const double height = dem__dot(d, up);
    double most = fabs(height) - dem__reach_along(s, core, dem__scale(height > 0.0 ? -1.0 : 1.0, up));
    dem_vec corner[3];
    if (most >= enough) return most;
    for (int c = 0; c < 3; c++) corner[c] = dem__into_core(core, dem__sub(t->vertex[t->corner[3 * k + c]], core->x));
    for (int f = 0; f < s->faces; f++) {
        const dem_vec n = dem__point(s->plane[f]);
        const double a = dem__dot(n, corner[0]), b = dem__dot(n, corner[1]), c = dem__dot(n, corner[2]);
        const double lowest = a < b ? (a < c ? a : c) : b < c ? b : c, apart = lowest - s->plane[f][3];
        most = apart > most ? apart : most;
    }
    return most;
}

/* Returns a core's place in the frame of a wall. */
static inline dem__placed dem__in_frame(const dem_wall *wall, const dem__placed *place) {
    dem__placed core;
    core.x = dem__to_frame(wall, dem__sub(place->x, wall->position));
    for (int k = 0; k < 3; k++) core.axis[k] = dem__to_frame(wall, place->axis[k]);
    return core;
}

/* Returns whether a triangle of a mesh may cut a core. */
static inline int dem__may_cut(const dem_wall *wall, const dem_convex *s, const dem__placed *place) {
    const dem__tree *t = wall->tree;
    const dem__placed core = dem__in_frame(wall, place);
    const double reach = s->reach - s->radius;
    for (int32_t b = 0; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, core.x, reach)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) {
            if (!(dem__apart_from_triangle(s, &core, t, k, 0.0) > 0.0)) return 1;
        }
    }
    return 0;
}

/* Finds the first triangle through which the line from p to q passes. Returns its index, -1: none. at: where. */
static inline int32_t dem__first_passed(const dem__tree *t, dem_vec p, dem_vec q, dem_vec *at) {
    const dem_vec u = dem__sub(q, p), middle = dem__plus(p, 0.5, u);
    const double half = 0.5 * dem__length(u);
    double first = 1.0;
    int32_t found = -1;
    for (int32_t b = 0; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, middle, 1.000001 * half)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) {
            const double here = dem__passes_at(t, k, p, q);
            if (here < first) first = here, found = k;
        }
    }
    *at = dem__plus(p, first, u);
    return found;
}

/* A place behind a sheet, in the mesh's frame. */
typedef struct dem__behind {
    const dem__tree *tree;
    dem_vec centre, x, at; /* the body's centre; the place; where the line between them first passes the sheet */
    int32_t first, best;   /* the triangle there; the nearest triangle */
    double distance;       /* to the nearest triangle [m] */
    dem_vec normal;        /* from the nearest triangle to the front */
} dem__behind;

/* Returns the normal of a triangle on the side of the centre, or 0 if the place is on that side, too. */
static inline dem_vec dem__front_of(const dem__behind *q, int32_t k) {
    const dem_vec n = q->tree->normal[k], a = q->tree->vertex[q->tree->corner[3 * k]];
    const double centre = dem__dot(n, dem__sub(q->centre, a)), x = dem__dot(n, dem__sub(q->x, a));
    return dem__scale(centre > 0.0 && x < 0.0 ? 1.0 : centre < 0.0 && x > 0.0 ? -1.0 : 0.0, n);
}

/* Takes triangle k if the place is behind it, and no triangle taken before is nearer. A triangle behind the first one
   and as good as parallel to it is the far side of a plate, which does not count. */
static inline void dem__try_behind(dem__behind *q, int32_t k) {
    const dem_vec front = dem__front_of(q, k), a = q->tree->vertex[q->tree->corner[3 * k]];
    double distance;
    int inside;
    if (dem__dot(front, front) == 0.0) return;
    const dem_vec v = dem__from_triangle(q->tree, k, q->x, &distance, &inside);
    if (!(distance < q->distance)) return;
    const double above = dem__dot(front, dem__sub(q->at, a));
    if (k != q->first && dem__dot(front, dem__front_of(q, q->first)) > DEM__SMOOTH && above > 1e-3 * distance) return;
    const dem_vec up = inside || !(distance > 0.0) ? front : dem__scale(-1.0 / distance, v);
    q->distance = distance, q->best = k, q->normal = up;
    if (dem__dot(up, front) > DEM__SMOOTH) return;
    q->normal = front; /* beyond a rim it is behind the plane */
}

/* Finds how deep a place is behind a mesh, seen from a body's centre. Returns 0 if it is not behind it. */
static inline int dem__find_behind(const dem_wall *wall, dem_vec centre, dem_vec x, dem__touch *out) {
    dem__behind q;
    q.tree = wall->tree, q.distance = HUGE_VAL;
    q.centre = dem__to_frame(wall, dem__sub(centre, wall->position)),
    q.x = dem__to_frame(wall, dem__sub(x, wall->position));
    q.first = dem__first_passed(q.tree, q.centre, q.x, &q.at);
    if (q.first < 0) return 0;
    q.best = q.first, q.normal = dem_vec3(0.0, 0.0, 0.0);
    dem__try_behind(&q, q.first);
    for (int32_t b = 0; b < q.tree->nodes;) {
        const dem__node *node = &q.tree->node[b];
        if (dem__is_far(node, q.x, q.distance)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) dem__try_behind(&q, k);
    }
    if (!(q.distance < HUGE_VAL)) return 0;
    const dem_vec a = q.tree->vertex[q.tree->corner[3 * q.best]];
    if (dem__dot(q.normal, dem__front_of(&q, q.best)) >= 1.0 - 1e-12)
        q.distance = fabs(dem__dot(q.normal, dem__sub(q.x, a)));
    out->gap = -q.distance, out->normal = dem__from_frame(wall, q.normal);
    out->curvature = 0.0, out->element = 0, out->face = -1;
    return 1;
}

/* Returns whether a curved sheet may cut a core, because an edge of the core passes through it. */
static DEM__NOINLINE int dem__sheet_cuts(const dem_wall *w, const dem_convex *s, const dem__placed *place) {
    dem_vec corner[DEM_CORNERS_MAX];
    for (int k = 0; k < s->corners; k++) corner[k] = dem__sub(dem__corner_at(s, place, k), w->position);
    for (int e = 0; e < s->edges; e++) {
        if (w->kind__->crosses(w, corner[s->edge[e][0]], corner[s->edge[e][1]])) return 1;
    }
    return 0;
}
