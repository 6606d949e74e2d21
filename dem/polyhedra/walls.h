/* Contacts of a polyhedron with a wall: its corners are spheres, its edges capsules, and its faces touch the wall's own
   corners. Reads a wall, a shape and its place. Promises: a point depends on these alone; forces are the gradient of a
   potential, as between polyhedra. */
#pragma once
#include "points.h"
#include "mesh_edges.h"

/* A polyhedron at a wall, seen from its centre, and the points found so far. */
typedef struct dem__at_wall {
    const dem_wall *wall;
    const dem_convex *shape;
    dem_vec centre;   /* of the polyhedron */
    dem__placed core; /* with x = 0 */
    dem__placed_edge edge[DEM_EDGES_MAX];
    int edges; /* length of the list; 0 until edges are needed */
    int n;
    dem__convex_point *out;
} dem__at_wall;

/* Keys of points: below 32, corners; then edges, five keys each; for a screen, the same again for each bar. */
enum {
    DEM__BAR_KEYS = DEM_CORNERS_MAX + 2 + 3 * 5 * DEM_EDGES_MAX,
    DEM__BARS_FROM = 1 << 18,               /* added to the number of a bar, which may be negative */
    DEM__MESH_PLACES = 54,                  /* directions of normals, for corners at a mesh */
    DEM__MESH_KEYS = 1 + 5 * DEM_EDGES_MAX, /* of an edge of a mesh and its corner */
    DEM__MESH_EDGES_MAX = (1 << 30) / DEM__MESH_KEYS,
    DEM__RING_POINTS = 16, /* points of a cone's rim at which faces can touch it */
    DEM__CROSSINGS_MAX = 4 /* of an edge with a cone, at most */
};

/* Returns the key of a corner at an element of a wall: a bar of a screen by its number, a place of a mesh by the
   direction of its normal in the wall's frame. */
static inline int32_t dem__wall_key(const dem_wall *wall, const dem__touch *touch, int corner) {
    if (wall->kind == DEM_SCREEN) return corner + DEM__BAR_KEYS * (touch->element + DEM__BARS_FROM);
    if (wall->kind != DEM_MESH) return corner;
    const double n[3] = {dem__dot(touch->normal, wall->axis[0]), dem__dot(touch->normal, wall->axis[1]),
                         dem__dot(touch->normal, wall->axis[2])};
    int most = fabs(n[1]) > fabs(n[0]) ? 1 : 0;
    most = fabs(n[2]) > fabs(n[most]) ? 2 : most;
    int32_t place = 2 * most + (n[most] < 0.0);
    for (int a = 1; a < 3; a++) {
        const double over = n[(most + a) % 3] / fabs(n[most]);
        place = 3 * place + (over < -0.41 ? 0 : over > 0.41 ? 2 : 1);
    }
    return corner + DEM_CORNERS_MAX * place;
}

/* Returns the element of a wall to which a key belongs. */
DEM_INLINE int32_t dem__element_of_key(const dem_wall *wall, int32_t key) {
    return wall->kind == DEM_SCREEN ? key / DEM__BAR_KEYS - DEM__BARS_FROM : 0;
}

/* Lists the edges of the polyhedron unless that is done. */
static inline void dem__list_edges(dem__at_wall *q) {
    dem__side side;
    if (q->edges > 0) return;
    memset(&side, 0, sizeof side);
    side.shape = q->shape, side.place = &q->core, side.limit = HUGE_VAL, side.sign = 1.0;
    for (int e = 0; e < q->shape->edges; e++) dem__place_edge(&side, e, 0, &q->edge[q->edges++]);
}

/* Sets an edge of a wall between two places, given from the polyhedron's centre. Returns 0 if it is too far away to
   touch. */
DEM_INLINE int dem__set_wall_edge(const dem__at_wall *q, dem_vec from, dem_vec to, double radius, int ends,
                                  dem__placed_edge *e) {
    const dem_vec u = dem__sub(to, from);
    dem_vec n;
    memset(e, 0, sizeof *e);
    e->length = dem__length(u);
    if (!(e->length > 0.0)) return 0;
    e->from = from, e->along = dem__scale(1.0 / e->length, u), e->ends = ends;
    return dem__from_edge(e, dem_vec3(0.0, 0.0, 0.0), &n) < q->shape->reach + radius;
}

/* Returns whether an edge of a wall lies wholly beyond a face of the core, by more than a distance. */
static inline int dem__is_beyond_face(const dem__at_wall *q, const dem__placed_edge *e, double distance) {
    const dem_vec from = dem__into_core(&q->core, e->from),
                  to = dem__plus(from, e->length, dem__into_core(&q->core, e->along));
    for (int f = 0; f < q->shape->faces; f++) {
        const dem_vec n = dem__point(q->shape->plane[f]);
        const double limit = q->shape->plane[f][3] + distance;
        if (dem__dot(n, from) > limit && dem__dot(n, to) > limit) return 1;
    }
    return 0;
}

/* Adds the points of all edges of the polyhedron at an edge of a wall with a radius. sign: 1 or -1 takes only those
   whose normals are on that side, 0 all. */
static inline void dem__cross_wall_edge(dem__at_wall *q, const dem__placed_edge *e, double radius, int32_t key,
                                        dem_vec side, double sign) {
    if (dem__is_beyond_face(q, e, DEM__WINDOW * (q->shape->radius + radius))) return;
    dem__list_edges(q);
    for (int k = 0; k < q->edges && q->n + 5 <= DEM__POINTS_MAX; k++) {
        const int n = dem__cross_edges(&q->edge[k], e, q->shape->radius + radius, !e->sided,
                                       key + 5 * q->edge[k].number, q->out + q->n);
        if (n == 0) continue;
        const double up = dem__dot(q->out[q->n].normal, side);
        if (sign == 0.0 || (sign > 0.0 ? up >= 0.0 : up < 0.0)) q->n += n;
    }
}

/* Adds the point of a wall's corner, a sphere with a radius at x, at the polyhedron's core. tip: its outward direction;
   0: it can be touched from all sides. */
static inline void dem__touch_wall_corner(dem__at_wall *q, dem_vec x, double radius, dem_vec tip, int32_t key) {
    dem__convex_point *point = &q->out[q->n];
    dem_vec n;
    if (q->n == DEM__POINTS_MAX || !(dem__length(x) < q->shape->reach + radius)) return;
    const double distance = dem__from_core(q->shape, &q->core, x, DEM__WINDOW * (radius + q->shape->radius), &n);
    point->gap = distance - radius - q->shape->radius;
    if (!(point->gap < 0.0) || dem__dot(n, tip) > 0.0) return;
    point->key = key, point->taken = 0, point->weight = 1.0;
    point->normal = dem__scale(-1.0, n), point->at = dem__plus(x, -distance, n);
    q->n++;
}

/* Adds the points of the polyhedron's corners, which are spheres. */
static inline void dem__touch_with_corners(dem__at_wall *q) {
    dem__touch touch[DEM__TOUCHES];
    double least;
    for (int k = 0; k < q->shape->corners; k++) {
        const dem_vec arm = dem__from_core_frame(&q->core, dem__point(q->shape->corner[k]));
        const int found = dem__touch_wall(q->wall, dem__add(q->centre, arm), q->shape->radius, 0.0, touch, &least);
        for (int m = 0; m < found && q->n < DEM__POINTS_MAX; m++) {
            dem__convex_point *point = &q->out[q->n];
            int is_new = touch[m].gap < 0.0;
            point->key = dem__wall_key(q->wall, &touch[m], k), point->taken = 0;
            point->normal = touch[m].normal, point->at = arm, point->gap = touch[m].gap, point->weight = 1.0;
            for (int p = q->n - 1; p >= q->n - m && is_new && p >= 0; p--) is_new = q->out[p].key != point->key;
            q->n += is_new;
        }
    }
}

/* Finds the ends of a bar's axis, from the screen's origin. Returns 0 if there is no such bar. */
static inline int dem__bar_ends(const dem_wall *w, int family, double index, dem_vec end[2]) {
    const double bar = (index - 0.5) * (w->aperture + w->wire), length = family ? w->half_y : w->half_x;
    dem_vec from;
    if (dem__reach_bar(w, family, index, 0.0, bar, 0.0, &from) < 0.0) return 0;
    const double reach = w->circular ? sqrt((w->half_x - bar) * (w->half_x + bar)) : length;
    for (int k = 0; k < 2; k++) end[k] = dem__from_bar(w, family, dem_vec3(k ? reach : -reach, bar, 0.0));
    return 1;
}
/* Finds the first and the last bar of a family near a polyhedron at d from the screen's origin; reach: its own [m]. */
DEM_INLINE void dem__bars_near(const dem_wall *w, int family, dem_vec d, double reach, double *first, double *last) {
    const double pitch = w->aperture + w->wire, across = dem__dot(d, w->axis[1 - family]),
                 half = family ? w->half_x : w->half_y;
    const double low = dem__clamp(across - reach - 0.5 * w->wire, -half, half);
    const double high = dem__clamp(across + reach + 0.5 * w->wire, -half, half);
    *first = floor(low / pitch + 0.5), *last = floor(high / pitch + 0.5);
}

/* Adds the points of edges at a bar. A half-round bar is a capsule when touched from above, and two sharp edges when
   touched from below. */
static inline void dem__touch_bar_with_edges(dem__at_wall *q, int family, double index, dem_vec d) {
    const dem_wall *w = q->wall;
    const double half = 0.5 * w->wire;
    const int32_t key = DEM__BAR_KEYS * (2 * (int32_t)index + family + DEM__BARS_FROM) + DEM_CORNERS_MAX;
    const dem_vec none = dem_vec3(0.0, 0.0, 0.0);
    dem__placed_edge e;
    dem_vec end[2];
    if (!dem__bar_ends(w, family, index, end)) return;
    for (int k = 0; k < 2; k++) end[k] = dem__sub(end[k], d);
    for (int k = 0; k < 2; k++) dem__touch_wall_corner(q, end[k], half, none, key + k);
    if (!dem__set_wall_edge(q, end[0], end[1], half, 3, &e)) return;
    dem__cross_wall_edge(q, &e, half, key + 2, w->axis[2], w->profile == DEM_ROUND ? 0.0 : 1.0);
    for (int side = -1; side < 2 && w->profile != DEM_ROUND; side += 2) {
        const dem_vec off = dem__scale(side * half, w->axis[1 - family]);
        if (dem__set_wall_edge(q, dem__add(end[0], off), dem__add(end[1], off), 0.0, 0, &e))
            dem__cross_wall_edge(q, &e, 0.0, key + 2 + 5 * DEM_EDGES_MAX * (side > 0 ? 2 : 1), w->axis[2], -1.0);
    }
}
/* Adds the points of edges at all bars near the polyhedron. */
static inline void dem__touch_screen_with_edges(dem__at_wall *q) {
    const dem_wall *w = q->wall;
    const dem_vec d = dem__sub(q->centre, w->position);
    double first, last;
    for (int family = 0; family < 2; family++) {
        dem__bars_near(w, family, d, q->shape->reach, &first, &last);
        for (double index = first; index <= last && q->n < DEM__POINTS_MAX; index += 1.0)
            dem__touch_bar_with_edges(q, family, index, d);
    }
}

/* Adds the points of edges across the outside of a cylinder, whose axis has no ends. */
static inline void dem__touch_cylinder_with_edges(dem__at_wall *q) {
    const dem_wall *w = q->wall;
    const dem_vec d = dem__sub(w->position, q->centre), foot = dem__plus(d, -dem__dot(d, w->axis[2]), w->axis[2]);
    const double far_off = 4.0 * (q->shape->reach + w->radius);
    dem__placed_edge e;
    if (dem__set_wall_edge(q, dem__plus(foot, -far_off, w->axis[2]), dem__plus(foot, far_off, w->axis[2]), w->radius, 0,
                           &e))
        dem__cross_wall_edge(q, &e, w->radius, DEM_CORNERS_MAX, w->axis[2], 0.0);
}

/* Returns the key of an edge of a mesh. Beyond 790 000 triangles keys repeat, but only far away: triangles are in the
   order of the tree. */
DEM_INLINE int32_t dem__mesh_key(int32_t at) {
    return DEM_CORNERS_MAX * DEM__MESH_PLACES + (int32_t)((int64_t)(at % DEM__MESH_EDGES_MAX) * DEM__MESH_KEYS);
}

/* Adds the points at the sharp edges and corners of a triangle. */
static inline void dem__touch_triangle_with_edges(dem__at_wall *q, int32_t k, dem_vec d) {
    const dem_wall *w = q->wall;
    const dem__tree *t = w->tree;
    dem__placed_edge e;
    for (int32_t at = 3 * k; at < 3 * k + 3; at++) {
        const int kind = t->edges->kind[at];
        const int32_t key = dem__mesh_key(at);
        if (!(kind & (DEM__EDGE | DEM__CORNER))) continue;
        const dem_vec from = dem__sub(dem__from_frame(w, t->vertex[t->corner[at]]), d);
        if (kind & DEM__CORNER) dem__touch_wall_corner(q, from, 0.0, dem__from_frame(w, t->edges->tip[at]), key);
        if (!(kind & DEM__EDGE)) continue;
        const dem_vec to = dem__sub(dem__from_frame(w, t->vertex[t->corner[at % 3 < 2 ? at + 1 : at - 2]]), d);
        const int ends = (kind & DEM__FROM_END ? 1 : 0) | (kind & DEM__TO_END ? 2 : 0);
        if (!dem__set_wall_edge(q, from, to, 0.0, ends, &e)) continue;
        e.sided = !(kind & DEM__RIM), e.outward = dem__from_frame(w, t->edges->outward[at]);
        dem__cross_wall_edge(q, &e, 0.0, key + 1, w->axis[2], 0.0);
    }
}
/* Adds the points at all triangles near the polyhedron. */
static inline void dem__touch_mesh_with_edges(dem__at_wall *q) {
    const dem__tree *t = q->wall->tree;
    const dem_vec d = dem__sub(q->centre, q->wall->position), p = dem__to_frame(q->wall, d);
    if (!t->edges) return;
    for (int32_t b = 0; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, p, q->shape->reach)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) dem__touch_triangle_with_edges(q, k, d);
    }
}

/* Returns the touch of a cone with the sphere about the point at t of an edge. */
DEM_INLINE dem__touch dem__touch_cone_along(const dem__at_wall *q, const dem__placed_edge *e, double t) {
    dem__touch touch;
    double least;
    const dem_vec d = dem__sub(dem__add(q->centre, dem__plus(e->from, t, e->along)), q->wall->position);
    touch.normal = q->wall->axis[2];
    dem__touch_cone(q->wall, d, dem__dot(d, q->wall->axis[2]), q->shape->radius, HUGE_VAL, &touch, &least);
    return touch;
}

/* Returns where an edge is nearest to a cone, between a place where it approaches and one where it recedes. */
static inline double dem__nearest_between(const dem__at_wall *q, const dem__placed_edge *e, double low, double high) {
    for (int k = 0; k < 50; k++) {
        const double middle = 0.5 * (low + high);
        if (dem__dot(dem__touch_cone_along(q, e, middle).normal, e->along) > 0.0) high = middle;
        else low = middle;
    }
    return 0.5 * (low + high);
}

/* Finds the places at which an edge touches a cone between its ends, by steps along it: long ones where no contact is
   possible, otherwise short ones. Returns their number. */
static inline int dem__nearest_along(const dem__at_wall *q, const dem__placed_edge *e, double *at) {
    const double step = 0.25 * q->shape->radius, least = 0.0625 * step;
    dem__touch was = dem__touch_cone_along(q, e, 0.0);
    int n = 0;
    for (double t = 0.0; t < e->length && n < DEM__CROSSINGS_MAX;) {
        const double ahead = was.gap <= 0.0    ? step
                             : was.gap > least ? was.gap
                                               : least,
                     next = t + ahead < e->length ? t + ahead : e->length;
        const dem__touch here = dem__touch_cone_along(q, e, next);
        if (was.gap < least && dem__dot(was.normal, e->along) < 0.0 && dem__dot(here.normal, e->along) > 0.0)
            at[n++] = dem__nearest_between(q, e, t, next);
        t = next, was = here;
    }
    return n;
}

/* Adds the point of an edge at t with a cone, and the points of the edge's ends, with weights as for crossing edges. */
static inline void dem__weigh_along(dem__at_wall *q, const dem__placed_edge *e, double t, int32_t key) {
    dem__convex_point *point = &q->out[q->n];
    double share[2], rest[2], left = 1.0;
    int n = 1;
    const dem__touch here = dem__touch_cone_along(q, e, t);
    if (!(here.gap < 0.0) || q->n + 3 > DEM__POINTS_MAX) return;
    for (int k = 0; k < 2; k++) {
        const dem__touch end = dem__touch_cone_along(q, e, k ? e->length : 0.0);
        share[k] = end.gap < 0.0 ? end.gap * end.gap / (here.gap * here.gap) : 0.0;
        rest[k] = share[k] < 1.0 ? 1.0 - share[k] : 0.0;
        left *= rest[k];
        if (share[k] == 0.0) continue;
        point[n].key = key + 1 + k, point[n].taken = 0, point[n].gap = end.gap, point[n].normal = end.normal;
        point[n].at = dem__plus(e->from, k ? e->length : 0.0, e->along), point[n].weight = k;
        n++;
    }
    if (!(left > 1e-10)) return;
    point->key = key, point->taken = 0, point->gap = here.gap, point->normal = here.normal;
    point->at = dem__plus(e->from, t, e->along), point->weight = left;
    for (int k = 0; k < 2; k++) point->weight += share[k] * left / rest[k];
    for (int m = 1; m < n; m++) point[m].weight = -left / rest[(int)point[m].weight];
    q->n += n;
}

/* Adds the points of edges at a cone and its rims, and of faces at points of the rims. */
static inline void dem__touch_cone_with_edges(dem__at_wall *q) {
    const dem_wall *w = q->wall;
    const int32_t rings = DEM_CORNERS_MAX + 3 * DEM__CROSSINGS_MAX * DEM_EDGES_MAX;
    double at[DEM__CROSSINGS_MAX];
    dem__list_edges(q);
    for (int k = 0; k < q->edges; k++) {
        const int n = dem__nearest_along(q, &q->edge[k], at);
        for (int m = 0; m < n; m++)
            dem__weigh_along(q, &q->edge[k], at[m], DEM_CORNERS_MAX + 3 * (DEM__CROSSINGS_MAX * q->edge[k].number + m));
    }
    for (int ring = 0; ring < 2; ring++) {
        const double radius = ring ? w->high_radius : w->radius;
        const dem_vec middle = dem__plus(dem__sub(w->position, q->centre), ring ? w->length : 0.0, w->axis[2]);
        if (!(dem__length(middle) < radius + q->shape->reach)) continue;
        for (int k = 0; k < (radius > 0.0 ? DEM__RING_POINTS : 1); k++) {
            const dem_vec out =
                dem__rotated(w->axis[0], w->axis[2], 2.0 * RIDDLE_PI / (double)DEM__RING_POINTS * (double)k);
            dem__touch_wall_corner(q, dem__plus(middle, radius, out), 0.0, dem_vec3(0.0, 0.0, 0.0),
                                   rings + DEM__RING_POINTS * ring + k);
        }
    }
}

/* Finds the points of a polyhedron at a wall, both at the end of the step. Returns their number. */
static inline int dem__touch_with_polyhedron(const dem_wall *wall, const dem_convex *s, const dem__placed *place,
                                             dem__convex_point *out) {
    dem__touch touch[DEM__TOUCHES];
    dem__at_wall q;
    double least;
    dem__touch_wall(wall, place->x, s->reach, 0.0, touch, &least);
    if (!(least < 0.0)) return 0;
    q.wall = wall, q.shape = s, q.centre = place->x, q.out = out, q.n = q.edges = 0;
    q.core = *place, q.core.x = dem_vec3(0.0, 0.0, 0.0);
    if (wall->kind == DEM_SPHERE && !wall->inside) {
        dem__touch_wall_corner(&q, dem__sub(wall->position, place->x), wall->radius, dem_vec3(0.0, 0.0, 0.0), 0);
        return q.n;
    }
    dem__touch_with_corners(&q);
    if (wall->kind == DEM_CYLINDER && !wall->inside) dem__touch_cylinder_with_edges(&q);
    if (wall->kind == DEM_SCREEN) dem__touch_screen_with_edges(&q);
    if (wall->kind == DEM_MESH) dem__touch_mesh_with_edges(&q);
    if (wall->kind == DEM_CONE) dem__touch_cone_with_edges(&q);
    return q.n;
}

/* Returns a lower limit of the distance between a core and a triangle of a mesh, given in the mesh's frame [m]: that
   along the normal of the triangle, or of a face of the core. If that is not above 0 it says nothing: they may be apart
   in another direction. */
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

/* Returns a lower limit of the distance between a core and a mesh, at most its reach [m]. place: of the core. */
static inline double dem__clear_of_mesh(const dem_wall *wall, const dem_convex *s, const dem__placed *place) {
    const dem__tree *t = wall->tree;
    dem__placed core;
    double least = s->reach;
    core.x = dem__to_frame(wall, dem__sub(place->x, wall->position));
    for (int k = 0; k < 3; k++) core.axis[k] = dem__to_frame(wall, place->axis[k]);
    for (int32_t b = 0; b < t->nodes && least > 0.0;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, core.x, s->reach + least)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) {
            const double apart = dem__apart_from_triangle(s, &core, t, k, least);
            least = apart < least ? apart : least;
        }
    }
    return least;
}

/* Returns a lower limit of the gap between a polyhedron that touches nothing and a wall [m]; 0 if none is known. */
static inline double dem__clear_of_wall(const dem_wall *wall, const dem_convex *s, const dem__placed *place) {
    dem__touch touch[DEM__TOUCHES];
    double least = HUGE_VAL, gap;
    if (wall->kind == DEM_MESH) return dem__clear_of_mesh(wall, s, place) - s->radius;
    if (wall->kind != DEM_PLANE && !(wall->inside && (wall->kind == DEM_CYLINDER || wall->kind == DEM_SPHERE)))
        return 0.0;
    for (int k = 0; k < s->corners; k++) { /* nothing of it is nearer than a corner */
        dem__touch_wall(wall, dem__corner_at(s, place, k), s->radius, 0.0, touch, &gap);
        least = gap < least ? gap : least;
    }
    return least;
}

/* ---- walls that cut a core ---- */

/* Returns whether the line from p to q passes through a triangle. */
static inline int dem__passes_triangle(dem_vec p, dem_vec q, dem_vec a, dem_vec b, dem_vec c) {
    const dem_vec n = dem__cross(dem__sub(b, a), dem__sub(c, a)), u = dem__sub(q, p);
    const dem_vec pa = dem__sub(a, p), pb = dem__sub(b, p), pc = dem__sub(c, p);
    if (!(dem__dot(n, pa) * dem__dot(n, dem__sub(a, q)) < 0.0)) return 0;
    const double ab = dem__dot(u, dem__cross(pa, pb)), bc = dem__dot(u, dem__cross(pb, pc)),
                 ca = dem__dot(u, dem__cross(pc, pa));
    return (ab >= 0.0 && bc >= 0.0 && ca >= 0.0) || (ab <= 0.0 && bc <= 0.0 && ca <= 0.0);
}
/* Returns whether the line from p to q, given from a cone's lower end, passes through the cone. */
static inline int dem__passes_cone(const dem_wall *w, dem_vec p, dem_vec q) {
    const dem_vec u = dem__sub(q, p);
    const double slope = (w->high_radius - w->radius) / w->length, z = dem__dot(p, w->axis[2]),
                 along = dem__dot(u, w->axis[2]);
    const double r = w->radius + slope * z, dr = slope * along; /* radius of the cone at p, and its change to q */
    const double a = dem__dot(u, u) - along * along - dr * dr, b = dem__dot(p, u) - z * along - r * dr;
    const double c = dem__dot(p, p) - z * z - r * r, root = sqrt(b * b > a * c ? b * b - a * c : 0.0);
    const double t[2] = {b > 0.0 ? c / (-b - root) : (root - b) / a, b > 0.0 ? (-b - root) / a : c / (root - b)};
    if (b * b < a * c) return 0;
    for (int k = 0; k < 2; k++) {
        if (t[k] >= 0.0 && t[k] <= 1.0 && z + t[k] * along >= 0.0 && z + t[k] * along <= w->length &&
            r + t[k] * dr >= 0.0)
            return 1;
    }
    return 0;
}
/* Returns whether an edge of a core, whose corners are given in a mesh's frame, passes through the mesh. */
static inline int dem__core_passes_mesh(const dem__tree *t, const dem_convex *s, const dem_vec *corner,
                                        dem_vec centre) {
    for (int32_t b = 0; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, centre, s->reach)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = 3 * node->first; k < 3 * (node->first + node->count); k += 3) {
            const dem_vec *v = t->vertex;
            const int32_t *c = t->corner + k;
            for (int e = 0; e < s->edges; e++) {
                if (dem__passes_triangle(corner[s->edge[e][0]], corner[s->edge[e][1]], v[c[0]], v[c[1]], v[c[2]]))
                    return 1;
            }
        }
    }
    return 0;
}
/* Returns whether some of the line from p to q, given in the core's frame, lies in the core. */
static inline int dem__core_holds_line(const dem_convex *s, dem_vec p, dem_vec q) {
    double low = 0.0, high = 1.0;
    for (int f = 0; f < s->faces; f++) {
        const dem_vec n = dem__point(s->plane[f]);
        const double from = dem__dot(n, p) - s->plane[f][3], to = dem__dot(n, q) - s->plane[f][3];
        if (from >= 0.0 && to >= 0.0) return 0;
        if (from > 0.0 && from / (from - to) > low) low = from / (from - to);
        if (to > 0.0 && from / (from - to) < high) high = from / (from - to);
    }
    return low < high;
}
static inline int dem__core_passes_screen(const dem_wall *w, const dem_convex *s, const dem__placed *place) {
    const dem_vec d = dem__sub(place->x, w->position);
    double first, last;
    dem_vec end[2];
    for (int family = 0; family < 2; family++) {
        dem__bars_near(w, family, d, s->reach, &first, &last);
        for (double index = first; index <= last; index += 1.0) {
            if (!dem__bar_ends(w, family, index, end)) continue;
            for (int k = 0; k < 2; k++) end[k] = dem__into_core(place, dem__sub(end[k], d));
            if (dem__core_holds_line(s, end[0], end[1])) return 1;
        }
    }
    return 0;
}
/* Returns whether a core has passed into a sheet, a mesh or a cone, or into the axis of a bar: beyond them its corners
   touch nothing. */
static inline int dem__core_passes(const dem_wall *w, const dem_convex *s, const dem__placed *place) {
    dem_vec corner[DEM_CORNERS_MAX];
    if (w->kind == DEM_SCREEN) return dem__core_passes_screen(w, s, place);
    for (int k = 0; k < s->corners; k++) corner[k] = dem__sub(dem__corner_at(s, place, k), w->position);
    for (int e = 0; e < s->edges && w->kind == DEM_CONE; e++) {
        if (dem__passes_cone(w, corner[s->edge[e][0]], corner[s->edge[e][1]])) return 1;
    }
    if (w->kind != DEM_MESH) return 0;
    for (int k = 0; k < s->corners; k++) corner[k] = dem__to_frame(w, corner[k]);
    return dem__core_passes_mesh(w->tree, s, corner, dem__to_frame(w, dem__sub(place->x, w->position)));
}
