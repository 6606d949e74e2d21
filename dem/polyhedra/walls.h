/* Contacts of a polyhedron with a wall. Its corners are spheres, its edges capsules, and its faces touch the wall's own
   corners. Reads a wall, a shape and its place. Promises: a point depends on these alone; forces are the gradient of a
   potential, as between polyhedra. */
#pragma once
#include "points.h"
#include "behind.h"
#include "mesh_edges.h"

/* A polyhedron at a wall, seen from its centre, and the points found so far. */
typedef struct dem__at_wall {
    dem__edge_visitor visitor; /* first, so that a visitor's address is that of this struct */
    const dem_wall *wall;
    const dem_convex *shape;
    double part;      /* of the spring of the pair that a corner has */
    dem_vec centre;   /* of the polyhedron */
    dem__placed core; /* with x = 0 */
    dem__placed_edge edge[DEM_EDGES_MAX];
    int edges;  /* length of the list; 0 until edges are needed */
    int is_cut; /* whether a sheet may cut the core: only then can corners be behind it */
    int n;
    dem__convex_point *out;
} dem__at_wall;

/* Returns the key of a corner: at an element of a wall by its index, at a place of a mesh by the direction of its
   normal in the wall's frame. */
static inline int32_t dem__wall_key(const dem_wall *wall, const dem__touch *touch, int corner) {
    if (dem__has_elements(wall)) return corner + DEM__ELEMENT_KEYS * (touch->element + DEM__ELEMENTS_FROM);
    if (!dem__has(wall, DEM__TRIANGULATED)) return corner;
    const double n[3] = {dem__dot(touch->normal, wall->axis[0]), dem__dot(touch->normal, wall->axis[1]),
                         dem__dot(touch->normal, wall->axis[2])};
    int most = fabs(n[1]) > fabs(n[0]) ? 1 : 0;
    most = fabs(n[2]) > fabs(n[most]) ? 2 : most;
    int32_t place = 2 * most + (n[most] < 0.0);
    for (int a = 1; a < 3; a++) { /* 18 degrees: normals of two contacts (DEM__SMOOTH) do not share a direction */
        const double over = n[(most + a) % 3] / fabs(n[most]);
        place = 5 * place + (over > -0.51) + (over > -0.158) + (over > 0.158) + (over > 0.51);
    }
    return corner + DEM_CORNERS_MAX * place;
}

/* Returns the element of a wall to which a key belongs. */
DEM_INLINE int32_t dem__element_of_key(const dem_wall *wall, int32_t key) {
    return dem__has_elements(wall) ? key / DEM__ELEMENT_KEYS - DEM__ELEMENTS_FROM : 0;
}

/* Lists the edges of the polyhedron unless they are listed. */
static inline void dem__list_edges(dem__at_wall *q) {
    dem__side side;
    if (q->edges > 0) return;
    memset(&side, 0, sizeof side);
    side.shape = q->shape, side.place = &q->core, side.limit = HUGE_VAL, side.sign = 1.0;
    for (int e = 0; e < q->shape->edges; e++) dem__place_edge(&side, e, 0, &q->edge[q->edges++]);
}

/* Places an edge of a wall. Returns 0 if it is too far away to touch. */
DEM_INLINE int dem__set_wall_edge(const dem__at_wall *q, const dem__wall_edge *of, dem__placed_edge *e) {
    const dem_vec u = dem__sub(of->to, of->from);
    dem_vec n;
    memset(e, 0, sizeof *e);
    e->length = dem__length(u);
    if (!(e->length > 0.0)) return 0;
    e->from = of->from, e->along = dem__scale(1.0 / e->length, u), e->ends = of->ends;
    if (!(dem__from_edge(e, dem_vec3(0.0, 0.0, 0.0), &n) < q->shape->reach + of->radius)) return 0;
    e->sided = of->is_sided, e->outward = of->outward;
    return 1;
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

/* Returns whether a part of the line from p to q, given in the core's frame, lies in the core. */
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

/* For an edge of a wall inside the core, finds the direction in which it is nearest to the core's surface, among those
   at which edges of the core cross it. Returns 0 if there is none. */
static DEM__NOINLINE int dem__find_way_out(const dem__at_wall *q, const dem__placed_edge *e, dem_vec *way) {
    double nearest = HUGE_VAL, s, distance;
    dem_vec n;
    for (int k = 0; k < q->edges; k++) {
        if (!dem__find_crossing(&q->edge[k], e, 0, &s, &n, &distance) || !(fabs(distance) < nearest)) continue;
        nearest = fabs(distance), *way = n;
    }
    return nearest < HUGE_VAL;
}

/* Adds the points of all edges of the polyhedron at an edge of a wall. If that edge is in the core, edges of the core
   tell its side, and only those count through which it entered. */
static inline void dem__cross_wall_edge(dem__edge_visitor *v, const dem__wall_edge *of) {
    dem__at_wall *q = (dem__at_wall *)(void *)v;
    dem__placed_edge e;
    dem_vec way;
    if (q->n == DEM__POINTS_MAX || !dem__set_wall_edge(q, of, &e)) return;
    const double radii = q->shape->radius + of->radius;
    if (dem__is_beyond_face(q, &e, DEM__WINDOW * radii)) return;
    dem__list_edges(q);
    const int is_deep =
        dem__core_holds_line(q->shape, dem__into_core(&q->core, of->from), dem__into_core(&q->core, of->to)) &&
        dem__find_way_out(q, &e, &way);
    if (is_deep) e.deep = dem__half_width(q->shape);
    for (int k = 0; k < q->edges && q->n + 5 <= DEM__POINTS_MAX; k++) {
        const int n = dem__cross_edges(&q->edge[k], &e, radii, !e.sided && !is_deep, q->part,
                                       of->key + 5 * q->edge[k].number, q->out + q->n);
        if (n == 0 || (is_deep && !(dem__dot(q->out[q->n].normal, way) > 0.7))) continue;
        const double up = dem__dot(q->out[q->n].normal, of->side);
        if (of->sign == 0.0 || (of->sign > 0.0 ? up >= 0.0 : up < 0.0)) q->n += n;
    }
}

/* Adds the point of a wall's corner at the polyhedron's core. */
static inline void dem__touch_wall_corner(dem__edge_visitor *v, dem_vec x, double radius, dem_vec tip, int32_t key) {
    dem__at_wall *q = (dem__at_wall *)(void *)v;
    dem__convex_point *point = &q->out[q->n];
    dem_vec n;
    if (q->n == DEM__POINTS_MAX || !(dem__length(x) < q->shape->reach + radius)) return;
    const double distance = dem__from_core(q->shape, &q->core, x, DEM__WINDOW * (radius + q->shape->radius), &n);
    const double gap = distance - radius - q->shape->radius;
    if (!(gap < 0.0) || dem__dot(n, tip) > 0.0) return;
    point->key = key;
    dem__count_point(point, q->part, gap);
    point->normal = dem__scale(-1.0, n), point->at = dem__plus(x, -distance, n);
    q->n++;
}

/* Finds where a sphere of the rounding at x touches a sheet that may cut the core. Behind the sheet its overlap goes on
   growing, along the normal to the front. Returns how many touches there are. */
static DEM__NOINLINE int dem__touch_cutting(const dem__at_wall *q, dem_vec x, double limit, dem__touch *touch) {
    const dem_wall *wall = q->wall;
    dem__touch behind;
    double least;
    int kept = 0, is_behind = 0;
    int found = dem__touch_wall(wall, x, q->shape->radius, limit, touch, &least);
    if (dem__has(wall, DEM__TRIANGULATED)) is_behind = dem__find_behind(wall, q->centre, x, &behind);
    else if (wall->kind__->crosses(wall, dem__sub(q->centre, wall->position), dem__sub(x, wall->position))) {
        dem__touch_wall(wall, x, q->shape->radius, HUGE_VAL, &behind, &least);
        behind.gap = -q->shape->radius - behind.gap, behind.normal = dem__scale(-1.0, behind.normal);
        is_behind = 1;
    }
    if (!is_behind) return found;
    behind.gap -= q->shape->radius;
    for (int m = 0; m < found; m++) { /* touches of other surfaces stay, those of this one's far side do not */
        if (dem__dot(touch[m].normal, behind.normal) > -0.5 && dem__dot(touch[m].normal, behind.normal) < 0.5)
            touch[kept++] = touch[m];
    }
    kept = kept < DEM__TOUCHES ? kept : DEM__TOUCHES - 1;
    for (int m = kept; m > 0; m--) touch[m] = touch[m - 1];
    touch[0] = behind;
    return kept + 1;
}

/* Adds the points of the polyhedron's corners, which are spheres. */
static inline void dem__touch_with_corners(dem__at_wall *q) {
    dem__touch touch[DEM__TOUCHES];
    const int is_flat = dem__has(q->wall, DEM__HALF_SPACE);
    const dem_vec up = dem__into_core(&q->core, q->wall->axis[2]);
    const double enough =
        1.000001 * q->shape->radius - dem__dot(dem__sub(q->centre, q->wall->position), q->wall->axis[2]);
    double least;
    for (int k = 0; k < q->shape->corners; k++) {
        if (is_flat && dem__dot(up, dem__point(q->shape->corner[k])) > enough) continue;
        const dem_vec arm = dem__from_core_frame(&q->core, dem__point(q->shape->corner[k])),
                      x = dem__add(q->centre, arm);
        const int found = q->is_cut ? dem__touch_cutting(q, x, 0.0, touch)
                                    : dem__touch_wall(q->wall, x, q->shape->radius, 0.0, touch, &least);
        for (int m = 0; m < found && q->n < DEM__POINTS_MAX; m++) {
            dem__convex_point *point = &q->out[q->n];
            int is_new = touch[m].gap < 0.0;
            point->key = dem__wall_key(q->wall, &touch[m], k);
            dem__count_point(point, q->part, touch[m].gap);
            point->normal = touch[m].normal, point->at = arm;
            for (int p = q->n - 1; p >= q->n - m && is_new && p >= 0; p--) is_new = q->out[p].key != point->key;
            q->n += is_new;
        }
    }
}

/* ---- curved sheets ---- */

/* Returns the touch of a sheet with the sphere about the point at t of an edge. */
static inline dem__touch dem__touch_sheet_along(const dem__at_wall *q, const dem__placed_edge *e, double t) {
    dem__touch touch[DEM__TOUCHES];
    const dem_vec x = dem__add(q->centre, dem__plus(e->from, t, e->along));
    double least;
    touch->normal = q->wall->axis[2];
    if (q->is_cut) dem__touch_cutting(q, x, HUGE_VAL, touch);
    else dem__touch_wall(q->wall, x, q->shape->radius, HUGE_VAL, touch, &least);
    return touch[0];
}

/* Returns where an edge is nearest to a sheet, between a place where it approaches and one where it recedes. */
static inline double dem__nearest_between(const dem__at_wall *q, const dem__placed_edge *e, double low, double high) {
    for (int k = 0; k < 50; k++) {
        const double middle = 0.5 * (low + high);
        if (dem__dot(dem__touch_sheet_along(q, e, middle).normal, e->along) > 0.0) high = middle;
        else low = middle;
    }
    return 0.5 * (low + high);
}

/* Finds the places at which an edge touches a sheet between its ends, by steps along it: long ones where no contact is
   possible, otherwise short ones, of a needle at most 4096. Returns how many. */
static inline int dem__nearest_along(const dem__at_wall *q, const dem__placed_edge *e, double *at) {
    const double fine = 0.25 * q->shape->radius, coarse = e->length / 4096.0, step = fine > coarse ? fine : coarse,
                 least = 0.0625 * step;
    dem__touch was = dem__touch_sheet_along(q, e, 0.0);
    int n = 0;
    for (double t = 0.0; t < e->length && n < DEM__CROSSINGS_MAX;) {
        const double ahead = was.gap <= 0.0    ? step
                             : was.gap > least ? was.gap
                                               : least,
                     next = t + ahead < e->length ? t + ahead : e->length;
        const dem__touch here = dem__touch_sheet_along(q, e, next);
        if (was.gap < least && dem__dot(was.normal, e->along) < 0.0 && dem__dot(here.normal, e->along) > 0.0)
            at[n++] = dem__nearest_between(q, e, t, next);
        t = next, was = here;
    }
    return n;
}

/* Adds the point of an edge at t with a sheet, and the points of the edge's ends, weighted as for crossing edges. */
static inline void dem__weigh_along(dem__at_wall *q, const dem__placed_edge *e, double t, int32_t key) {
    dem__convex_point *point = &q->out[q->n];
    int n = 1;
    const dem__touch here = dem__touch_sheet_along(q, e, t);
    if (!(here.gap < 0.0) || q->n + 3 > DEM__POINTS_MAX) return;
    point->key = key, point->taken = 0, point->gap = here.gap, point->normal = here.normal;
    point->at = dem__plus(e->from, t, e->along);
    for (int k = 0; k < 2; k++) {
        const dem__touch end = dem__touch_sheet_along(q, e, k ? e->length : 0.0);
        if (!(end.gap < 0.0)) continue;
        point[n].key = key + 1 + k, point[n].taken = 0, point[n].gap = end.gap, point[n].normal = end.normal;
        point[n].at = dem__plus(e->from, k ? e->length : 0.0, e->along);
        n++;
    }
    if (dem__weigh_crossing(point, n, q->part)) q->n += n;
}

/* Adds the points of edges at a sheet and its rims. */
static inline void dem__touch_sheet_with_edges(dem__at_wall *q) {
    double at[DEM__CROSSINGS_MAX];
    dem__list_edges(q);
    for (int k = 0; k < q->edges; k++) {
        const int n = dem__nearest_along(q, &q->edge[k], at);
        for (int m = 0; m < n; m++)
            dem__weigh_along(q, &q->edge[k], at[m], DEM_CORNERS_MAX + 3 * (DEM__CROSSINGS_MAX * q->edge[k].number + m));
    }
}

/* How the corners of a polyhedron tell its gap to a wall. */
DEM_INLINE int dem__corners_at(const dem_wall *wall) {
    return wall->kind__->corners ? wall->kind__->corners(wall) : DEM__CORNERS_SOME;
}

/* Finds the points of a polyhedron at a wall, both at the end of the step. The sphere around it touches the wall.
   Returns how many. may_cut: whether a sheet may cut its core. */
static DEM__NOINLINE int dem__touch_with_polyhedron(const dem_wall *wall, const dem_convex *s, const dem__placed *place,
                                                    dem__convex_point *out, int *may_cut) {
    dem__at_wall q;
    *may_cut = 0;
    q.visitor.corner = dem__touch_wall_corner, q.visitor.edge = dem__cross_wall_edge;
    q.wall = wall, q.shape = s, q.part = dem__part_of(s), q.centre = place->x, q.out = out, q.n = q.edges = 0;
    q.core = *place, q.core.x = dem_vec3(0.0, 0.0, 0.0);
    q.is_cut = 0;
    if (dem__has(wall, DEM__TRIANGULATED)) q.is_cut = dem__may_cut(wall, s, place);
    else if (wall->kind__->crosses) q.is_cut = dem__sheet_cuts(wall, s, place);
    if (dem__corners_at(wall) != DEM__CORNERS_NONE) dem__touch_with_corners(&q);
    if (dem__has(wall, DEM__CURVED_SHEET)) dem__touch_sheet_with_edges(&q);
    if (wall->kind__->edges) wall->kind__->edges(wall, place->x, s->reach, &q.visitor);
    *may_cut = q.is_cut;
    return q.n;
}

/* Returns a lower limit of the distance between a core and a mesh, at most its reach [m]. place: the core's. */
static inline double dem__clear_of_mesh(const dem_wall *wall, const dem_convex *s, const dem__placed *place) {
    const dem__tree *t = wall->tree;
    const dem__placed core = dem__in_frame(wall, place);
    double least = s->reach;
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
    if (dem__has(wall, DEM__TRIANGULATED)) return dem__clear_of_mesh(wall, s, place) - s->radius;
    if (dem__corners_at(wall) != DEM__CORNERS_ALL) return 0.0;
    for (int k = 0; k < s->corners; k++) {
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
/* Looks for a bar's axis that passes through a core. */
typedef struct dem__axis_visitor {
    dem__edge_visitor visitor;
    const dem_convex *shape;
    const dem__placed *place;
    int found;
} dem__axis_visitor;
static inline void dem__skip_corner(dem__edge_visitor *v, dem_vec x, double radius, dem_vec tip, int32_t key) {
    (void)v, (void)x, (void)radius, (void)tip, (void)key;
}
static inline void dem__look_at_axis(dem__edge_visitor *v, const dem__wall_edge *e) {
    dem__axis_visitor *q = (dem__axis_visitor *)(void *)v;
    if (q->found || !e->is_axis) return;
    q->found = dem__core_holds_line(q->shape, dem__into_core(q->place, e->from), dem__into_core(q->place, e->to));
}

/* Returns whether a core has passed into a sheet, a mesh, a cone, or the axis of a bar. Beyond them its corners touch
   nothing. */
static inline int dem__core_passes(const dem_wall *w, const dem_convex *s, const dem__placed *place) {
    dem_vec corner[DEM_CORNERS_MAX];
    if (dem__has_elements(w)) {
        dem__axis_visitor q;
        q.visitor.corner = dem__skip_corner, q.visitor.edge = dem__look_at_axis;
        q.shape = s, q.place = place, q.found = 0;
        w->kind__->edges(w, place->x, s->reach, &q.visitor);
        return q.found;
    }
    for (int k = 0; k < s->corners; k++) corner[k] = dem__sub(dem__corner_at(s, place, k), w->position);
    for (int e = 0; e < s->edges && w->kind__->crosses; e++) {
        if (w->kind__->crosses(w, corner[s->edge[e][0]], corner[s->edge[e][1]])) return 1;
    }
    if (!dem__has(w, DEM__TRIANGULATED)) return 0;
    for (int k = 0; k < s->corners; k++) corner[k] = dem__to_frame(w, corner[k]);
    return dem__core_passes_mesh(w->tree, s, corner, dem__to_frame(w, dem__sub(place->x, w->position)));
}
