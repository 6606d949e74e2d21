/* The points at which two rounded polyhedra touch: corners of each at the other, and edges that cross. Promises: a
   point depends only on its own two features; weight times overlap along the normals is the gradient of a potential (of
   a linear law), and continuous in the motion. */
#pragma once
#include "distance.h"

enum {
    DEM__POINTS_MAX = 256
}; /* greatest number of points of a pair, enough for a plate on 60 wires; further points are left out */
#define DEM__WINDOW                                                                                                    \
    1.000001 /* features are tested up to this multiple of the radii, so that rounding of directions does not decide   \
              */

/* Returns the part that a corner of a body has of the spring of a pair. */
DEM_INLINE double dem__part_of(const dem_convex *s) { return 1.0 / (double)s->springs; }

/* Sets what a point has that is a corner. part: of the spring of its pair. */
DEM_INLINE void dem__count_point(dem__convex_point *p, double part, double gap) {
    p->taken = 0;
    p->gap = gap, p->weight = p->count = part;
}

/* Sets the weights of the point of a crossing, p[0], and of those of its n - 1 ends: p[0] and p[k] have the overlaps D
   and D_k, and forces are the gradient of part D^2 product(1 - (D_k/D)^2) k/2. Returns 0 if nothing is left of that. */
DEM_INLINE int dem__weigh_crossing(dem__convex_point *p, int n, double part) {
    double rest[5], left = part, sum = 1.0;
    for (int k = 1; k < n; k++) {
        const double ratio = p[k].gap / p[0].gap, share = ratio * ratio;
        rest[k] = share < 1.0 ? 1.0 - share : 0.0;
        left *= rest[k], sum += share / rest[k];
    }
    if (!(left > 1e-10 * part)) return 0;
    p[0].weight = left * sum, p[0].count = left;
    for (int k = 1; k < n; k++) p[k].weight = -left / rest[k], p[k].count = 0.0;
    return 1;
}

/* Returns the signed distance of a point p from a box, in its frame. n: the direction away from it. Beyond `enough`,
   returns any larger value without a direction. */
DEM_INLINE double dem__from_box(dem_vec half, dem_vec p, double enough, dem_vec *n) {
    const dem_vec out = dem_vec3(fabs(p.x) - half.x, fabs(p.y) - half.y, fabs(p.z) - half.z);
    const dem_vec d = dem_vec3(out.x > 0.0 ? out.x : 0.0, out.y > 0.0 ? out.y : 0.0, out.z > 0.0 ? out.z : 0.0);
    const dem_vec side = dem_vec3(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0, p.z < 0.0 ? -1.0 : 1.0);
    const double square = dem__dot(d, d);
    if (square > enough * enough) return HUGE_VAL;
    if (square > 0.0) {
        const double distance = sqrt(square);
        *n = dem_vec3(side.x * d.x / distance, side.y * d.y / distance, side.z * d.z / distance);
        return distance;
    }
    const int k = out.x > out.y ? (out.x > out.z ? 0 : 2) : out.y > out.z ? 1 : 2;
    *n = dem_vec3(k == 0 ? side.x : 0.0, k == 1 ? side.y : 0.0, k == 2 ? side.z : 0.0);
    return dem_axis(out, k);
}

/* Returns whether the projection of a point p on face f lies within it. */
DEM_INLINE int dem__over_face(const dem_convex *s, int f, dem_vec p) {
    const dem_vec n = dem__point(s->plane[f]);
    for (int k = s->face_start[f], end = s->face_start[f + 1]; k < end; k++) {
        const dem_vec from = dem__point(s->corner[s->face_corner[k]]),
                      to = dem__point(s->corner[s->face_corner[k + 1 < end ? k + 1 : s->face_start[f]]]);
        if (dem__dot(dem__cross(n, dem__sub(to, from)), dem__sub(p, from)) < 0.0) return 0;
    }
    return 1;
}

/* Returns the signed distance of a point p from a core that is not a box. n: the direction away from it. Beyond
   `enough`, returns any larger value. */
static inline double dem__from_near_faces(const dem_convex *s, dem_vec p, double enough, dem_vec *n) {
    int top = -1;
    double highest = -HUGE_VAL, least = HUGE_VAL;
    for (int f = 0; f < s->faces; f++) {
        const double height = dem__dot(dem__point(s->plane[f]), p) - s->plane[f][3];
        if (height > highest) highest = height, top = f;
    }
    *n = top < 0 ? dem_vec3(0.0, 0.0, 1.0) : dem__point(s->plane[top]);
    if (highest > enough) return highest;
    for (int f = 0; f < s->faces; f++) {
        const double height = dem__dot(dem__point(s->plane[f]), p) - s->plane[f][3];
        if ((f != top && !(height > 0.0)) || !dem__over_face(s, f, p)) continue;
        *n = dem__point(s->plane[f]);
        return height;
    }
    dem_vec off = dem_vec3(0.0, 0.0, 0.0);
    for (int e = 0; e < s->edges || e == 0; e++) { /* a point has a corner, but no edge */
        const dem_vec from = dem__point(s->corner[s->edge[e][0]]),
                      u = dem__sub(dem__point(s->corner[s->edge[e][1]]), from);
        const double length = dem__dot(u, u),
                     t = length > 0.0 ? dem__clamp(dem__dot(dem__sub(p, from), u) / length, 0.0, 1.0) : 0.0;
        const dem_vec d = dem__sub(p, dem__plus(from, t, u));
        const double square = dem__dot(d, d);
        if (square < least) least = square, off = d;
    }
    const double distance = sqrt(least);
    if (distance > 1e-12 * s->reach) *n = dem__scale(1.0 / distance, off);
    return distance;
}
static inline double dem__from_faces(const dem_convex *s, dem_vec p, dem_vec *n) {
    return dem__from_near_faces(s, p, HUGE_VAL, n);
}

/* Returns the signed distance of a point, given in the frame of a core, from the core. n: the direction away from it,
   in the world. Beyond `enough`, returns any larger value. */
DEM_INLINE double dem__from_core_in(const dem_convex *s, const dem__placed *place, dem_vec x, double enough,
                                    dem_vec *n) {
    dem_vec m = dem_vec3(0.0, 0.0, 1.0);
    const double distance = s->is_box ? dem__from_box(s->half, x, enough, &m) : dem__from_near_faces(s, x, enough, &m);
    *n = distance > enough ? m : dem__from_core_frame(place, m);
    return distance;
}

/* Returns the same of a point p of the world. */
DEM_INLINE double dem__from_core(const dem_convex *s, const dem__placed *place, dem_vec p, double enough, dem_vec *n) {
    return dem__from_core_in(s, place, dem__into_core(place, dem__sub(p, place->x)), enough, n);
}

/* An edge in the world: where it begins, its direction and length; in each of its two faces the direction away from it;
   the sum of their normals. */
typedef struct dem__placed_edge {
    dem_vec from, along, in[2], outward;
    double length, middle,
        half;         /* [m]; of the part near the other core: its middle, along the edge, and half its length */
    int number, ends; /* ends: bits of the ends that are corners, which have their own points */
    int sided;        /* edge of a wall: whether it is touched only from the side of `outward` */
    double deep;      /* edge of a wall: how much deeper than the radii it may be in the core [m] */
} dem__placed_edge;

/* Heights of corners along a direction, and which corners are near the other core. */
typedef struct dem__side {
    const dem_convex *shape;
    const dem__placed *place;
    double height[DEM_CORNERS_MAX], limit; /* limit: a corner is near if sign times its height is below it */
    double sign;
    int n; /* near corners */
    uint8_t corner[DEM_CORNERS_MAX], is_near[DEM_CORNERS_MAX];
    dem_vec *seen; /* all corners in the frame of the other core, if that is a box */
} dem__side;

/* Finds the corners in the frame of the other core, if that is a box. */
DEM_INLINE void dem__see_corners(dem__side *side, const dem__side *other) {
    const dem__placed *frame = other->place;
    dem__placed seen;
    if (!other->shape->is_box) return;
    seen.x = dem__into_core(frame, dem__sub(side->place->x, frame->x));
    for (int k = 0; k < 3; k++) seen.axis[k] = dem__into_core(frame, side->place->axis[k]);
    for (int k = 0; k < side->shape->corners; k++) side->seen[k] = dem__corner_at(side->shape, &seen, k);
}

DEM_INLINE void dem__find_heights(dem__side *side, dem_vec n, double *lowest, double *highest) {
    const double centre = dem__dot(n, side->place->x);
    const dem_vec in_body = dem__into_core(side->place, n), half = side->shape->half;
    for (int k = 0; k < side->shape->corners; k++)
        side->height[k] = centre + dem__dot(in_body, dem__point(side->shape->corner[k]));
    if (side->shape->is_box) {
        const double reach = fabs(in_body.x) * half.x + fabs(in_body.y) * half.y + fabs(in_body.z) * half.z;
        *lowest = centre - reach, *highest = centre + reach;
        return;
    }
    *lowest = HUGE_VAL, *highest = -HUGE_VAL;
    for (int k = 0; k < side->shape->corners; k++) {
        const double h = side->height[k];
        *lowest = h < *lowest ? h : *lowest, *highest = h > *highest ? h : *highest;
    }
}

/* Chooses the corners whose height times sign is below `low`. */
DEM_INLINE void dem__choose_corners(dem__side *side, double low, double sign) {
    side->n = 0, side->limit = low, side->sign = sign;
    for (int k = 0; k < side->shape->corners; k++) { /* without branches here and below: they could not be predicted */
        side->corner[side->n] = (uint8_t)k;
        side->n += side->is_near[k] = sign * side->height[k] < low;
    }
}

/* Finds the part of edge e that is near the other core: all of it, or from its near end to the limit. */
DEM_INLINE void dem__find_near_part(const dem__side *side, int e, dem__placed_edge *p) {
    const uint8_t *end = side->shape->edge[e];
    const double a = side->sign * side->height[end[0]], b = side->sign * side->height[end[1]];
    const double at_limit = p->length * ((side->limit - a) / (b != a ? b - a : 1.0));
    const double from = a < side->limit ? 0.0 : at_limit, to = b < side->limit ? p->length : at_limit;
    p->middle = 0.5 * (from + to);
    p->half = 0.5 * (to - from);
}

/* Returns whether edge e ends at a near corner. */
DEM_INLINE int dem__is_near_edge(const dem__side *side, int e) {
    return side->is_near[side->shape->edge[e][0]] | side->is_near[side->shape->edge[e][1]];
}

/* Places edge e in the world. apart: the cores do not overlap, and the directions in its faces are not used. */
static inline void dem__place_edge(const dem__side *side, int e, int apart, dem__placed_edge *p) {
    const dem_convex *s = side->shape;
    const int from = s->edge[e][0], to = s->edge[e][1];
    const dem_vec u = dem__sub(dem__point(s->corner[to]), dem__point(s->corner[from]));
    p->number = e, p->ends = 3, p->sided = 0, p->deep = 0.0;
    p->from = dem__corner_at(s, side->place, from);
    if (s->is_box) { /* along an axis */
        const int k = !(fabs(u.x) > 0.0) * (1 + !(fabs(u.y) > 0.0));
        const double along = u.x + u.y + u.z;
        p->length = fabs(along), p->along = dem__scale(along < 0.0 ? -1.0 : 1.0, side->place->axis[k]);
    } else {
        p->length = dem__length(u), p->along = dem__from_core_frame(side->place, dem__scale(1.0 / p->length, u));
    }
    p->outward = p->in[0] = p->in[1] = dem_vec3(0.0, 0.0, 0.0); /* a segment has no faces */
    if (apart) return;
    for (int f = 0; f < 2 && s->faces > 0; f++) {
        const dem_vec n = dem__from_core_frame(side->place, dem__point(s->plane[s->edge_face[e][f]]));
        p->outward = dem__add(p->outward, n);
        p->in[f] = dem__cross(n, f ? dem__scale(-1.0, p->along) : p->along);
    }
    if (dem__dot(p->outward, p->outward) < 1e-6) p->outward = dem__scale(-1.0, p->in[0]); /* the rim of a sheet */
}

/* Returns how far the direction n, away from an edge, leans over one of its faces; 0 if it is between their normals. */
DEM_INLINE double dem__lean(const dem__placed_edge *e, dem_vec n) {
    double lean = 0.0;
    for (int f = 0; f < 2; f++) {
        const double over = dem__dot(n, e->in[f]);
        lean = over > lean ? over : lean;
    }
    return lean;
}

/* Returns the vector from the nearest point of an edge to x. */
DEM_INLINE dem_vec dem__off_edge(const dem__placed_edge *e, dem_vec x) {
    const dem_vec d = dem__sub(x, e->from);
    return dem__plus(d, -dem__clamp(dem__dot(d, e->along), 0.0, e->length), e->along);
}
/* Returns whether x is farther than a distance from an edge. */
DEM_INLINE int dem__is_off_edge(const dem__placed_edge *e, dem_vec x, double distance) {
    const dem_vec off = dem__off_edge(e, x);
    return dem__dot(off, off) > distance * distance;
}
/* Returns the distance of a corner from an edge; n: the unit vector from the nearest point to it. */
DEM_INLINE double dem__from_edge(const dem__placed_edge *e, dem_vec x, dem_vec *n) {
    const dem_vec off = dem__off_edge(e, x);
    const double distance = dem__length(off);
    *n = distance > 0.0 ? dem__scale(1.0 / distance, off) : dem_vec3(0.0, 0.0, 1.0);
    return distance;
}

/* Finds where two edges cross: s along p, the unit vector from q to p, and the signed distance. Returns 0 if they do
   not cross. apart: the cores do not overlap, so the nearest points give the direction. */
static inline int dem__find_crossing(const dem__placed_edge *p, const dem__placed_edge *q, int apart, double *s,
                                     dem_vec *normal, double *distance) {
    const dem_vec d = dem__sub(p->from, q->from), product = dem__cross(p->along, q->along);
    const double c = dem__dot(p->along, q->along), square = dem__dot(product, product);
    if (!(square > 1e-12)) return 0; /* parallel: corners suffice */
    const double on_p = dem__dot(d, p->along), on_q = dem__dot(d, q->along), s_square = c * on_q - on_p,
                 t_square = on_q - c * on_p;
    const double wide = DEM__WINDOW * square; /* most do not cross, which shows without a division */
    if (!((s_square > 0.0) & (s_square < p->length * wide) & (t_square > 0.0) & (t_square < q->length * wide)))
        return 0;
    const double t = t_square / square;
    *s = s_square / square;
    if (!(*s > 0.0 && *s < p->length && t > 0.0 && t < q->length)) return 0;
    const dem_vec from_q = dem__sub(dem__plus(p->from, *s, p->along), dem__plus(q->from, t, q->along));
    const dem_vec guide = apart ? from_q : dem__sub(q->outward, p->outward);
    *normal = dem__scale((dem__dot(product, guide) < 0.0 ? -1.0 : 1.0) / sqrt(square), product);
    *distance = dem__dot(*normal, from_q);
    if (q->sided) {
        if (dem__dot(*normal, q->outward) < 0.0) *normal = dem__scale(-1.0, *normal), *distance = -*distance;
        return dem__dot(*normal, p->outward) < 0.0;
    }
    return apart || *distance > 0.0 || (dem__lean(p, dem__scale(-1.0, *normal)) < 0.25 && dem__lean(q, *normal) < 0.25);
}

/* Finds the points where edge p of a crosses edge q of b. Returns their number. The energy of the overlap at the
   crossing counts only beyond that of the ends of the edges, each with its overlap at the other edge: it is 0 with
   slope 0 where the crossing reaches an end, and that corner's own point continues. The point of the crossing gets
   `key`, those of the ends the next four. part: of the spring of the pair. */
static inline int dem__cross_edges(const dem__placed_edge *p, const dem__placed_edge *q, double radii, int apart,
                                   double part, int32_t key, dem__convex_point *out) {
    double s, distance;
    if (!dem__find_crossing(p, q, apart, &s, &out->normal, &distance)) return 0;
    const double overlap = radii - distance;
    /* deeper: they lie on far sides of the cores */
    if (!(overlap > 0.0) || !(overlap < 2.0 * radii + q->deep)) return 0;
    int n = 1;
    out->key = key, out->taken = 0;
    out->gap = -overlap;
    out->at = dem__plus(p->from, s, p->along);
    for (int k = 0; k < 4; k++) {
        const dem__placed_edge *own = k < 2 ? p : q, *other = k < 2 ? q : p;
        const dem_vec x = k % 2 ? dem__plus(own->from, own->length, own->along) : own->from;
        dem__convex_point *end = &out[n];
        dem_vec off;
        if (!(own->ends >> k % 2 & 1) || dem__is_off_edge(other, x, DEM__WINDOW * radii)) continue;
        const double from = dem__from_edge(other, x, &off);
        if (!(from < radii)) continue;
        end->key = out->key + 1 + k, end->taken = 0, end->gap = from - radii;
        end->normal = dem__scale(k < 2 ? 1.0 : -1.0, off);
        end->at = k < 2 ? x : dem__plus(x, -from, off);
        n++;
    }
    return dem__weigh_crossing(out, n, part) ? n : 0;
}

/* Returns whether a point, given in the frame of a box, is farther than a distance beyond a side of it. */
DEM_INLINE int dem__passes_box(dem_vec half, dem_vec x, double distance) {
    return (fabs(x.x) > half.x + distance) | (fabs(x.y) > half.y + distance) | (fabs(x.z) > half.z + distance);
}

/* Appends the points of corners of a at b to a list of n. Returns the new number. key: of a's first corner; if it is
   above 0, a and b are exchanged. */
static inline int dem__find_corner_points(const dem__side *a, const dem__side *b, int key, dem__convex_point *out,
                                          int n) {
    const double radii = a->shape->radius + b->shape->radius, part = dem__part_of(a->shape);
    for (int m = 0; m < a->n && n < DEM__POINTS_MAX; m++) {
        const int k = a->corner[m];
        dem__convex_point *p = &out[n];
        if (b->shape->is_box && dem__passes_box(b->shape->half, a->seen[k], DEM__WINDOW * radii)) continue;
        const dem_vec x = dem__corner_at(a->shape, a->place, k),
                      in_b = b->shape->is_box ? a->seen[k] : dem__into_core(b->place, dem__sub(x, b->place->x));
        const double distance = dem__from_core_in(b->shape, b->place, in_b, DEM__WINDOW * radii, &p->normal);
        if (!(distance < radii)) continue;
        p->key = key + k, p->at = x;
        dem__count_point(p, part, distance - radii);
        if (key > 0) { /* a and b are exchanged */
            p->at = dem__plus(x, -distance, p->normal);
            p->normal = dem__scale(-1.0, p->normal);
        }
        n++;
    }
    return n;
}

/* Returns to which sides of a box the near part of edge e of another core comes close: bits 2 k and 2 k + 1 for the
   lower and the upper side across axis k. Returns 0 if these are not two sides that meet in an edge. */
DEM_INLINE unsigned dem__sides_near(const dem__side *side, int e, const dem_convex *box, double radii) {
    const uint8_t *end = side->shape->edge[e];
    const double a = side->sign * side->height[end[0]], b = side->sign * side->height[end[1]];
    const double at_limit = (side->limit - a) / (b != a ? b - a : 1.0);
    const double begins = a < side->limit ? 0.0 : at_limit, ends = b < side->limit ? 1.0 : at_limit;
    const dem_vec from = side->seen[end[0]], u = dem__sub(side->seen[end[1]], from);
    const dem_vec at = dem__plus(from, 0.5 * (begins + ends), u);
    const double half_part = 0.5 * (ends - begins);
    const double x[3] = {at.x, at.y, at.z}, half[3] = {box->half.x, box->half.y, box->half.z};
    const double reach[3] = {half_part * fabs(u.x) + radii, half_part * fabs(u.y) + radii,
                             half_part * fabs(u.z) + radii};
    unsigned sides = 0, across = 0, passes = 0;
    for (int k = 0; k < 3; k++) {
        const unsigned low = fabs(x[k] + half[k]) < reach[k], high = fabs(x[k] - half[k]) < reach[k];
        passes |= fabs(x[k]) > half[k] + reach[k];
        sides |= low << 2 * k | high << (2 * k + 1);
        across += low | high;
    }
    return sides * (unsigned)(!passes & (across > 1));
}

/* Edges of a core that end at a near corner. */
typedef struct dem__edge_list {
    int n;
    uint8_t number[DEM_EDGES_MAX];
    uint8_t sides[DEM_EDGES_MAX]; /* of a box: the sides that meet at an edge; otherwise the sides of the other box that
                                     it is not close to */
} dem__edge_list;

/* Lists the edges that end at a near corner. */
static inline void dem__list_near_edges(const dem__side *side, dem__edge_list *list) {
    list->n = 0;
    for (int e = 0; e < side->shape->edges; e++) {
        list->number[list->n] = (uint8_t)e;
        list->n += dem__is_near_edge(side, e);
    }
}
/* Finds the sides of a box that meet at its edges. */
static inline void dem__find_sides(const dem__side *side, dem__edge_list *list) {
    const dem_convex *s = side->shape;
    unsigned of[6] = {0, 0, 0, 0, 0, 0};
    for (int f = 0; f < 6 && s->is_box; f++) {
        const double *n = s->plane[f];
        of[f] = 1u << (2 * (fabs(n[1]) > 0.5) + 4 * (fabs(n[2]) > 0.5) + (n[0] + n[1] + n[2] > 0.0));
    }
    for (int m = 0; m < list->n; m++) {
        const uint8_t *face = s->edge_face[list->number[m]];
        list->sides[m] = s->is_box ? (uint8_t)(of[face[0]] | of[face[1]]) : 0;
    }
}
/* Keeps the edges of a list that can cross an edge of the other core. */
static inline void dem__keep_edges(const dem__side *side, const dem__side *other, double radii, dem__edge_list *list) {
    int kept = 0;
    for (int m = 0; m < list->n; m++) {
        const uint8_t number = list->number[m];
        list->number[kept] = number;
        const unsigned sides = other->shape->is_box ? dem__sides_near(side, number, other->shape, radii) : 63u;
        list->sides[kept] = (uint8_t)~sides;
        kept += sides > 0;
    }
    list->n = kept;
}

/* Returns whether the near parts of two edges are farther from each other than a distance. */
DEM_INLINE int dem__are_apart(const dem__placed_edge *p, const dem__placed_edge *q, double distance) {
    const dem_vec d = dem__sub(dem__plus(p->from, p->middle, p->along), dem__plus(q->from, q->middle, q->along));
    const double far_off = p->half + q->half + distance;
    return dem__dot(d, d) >= far_off * far_off;
}

/* Appends the points where edges cross to a list of n. Returns the new number. Begins with the core that has fewer near
   edges: if none of these can cross an edge of the other core, nothing else is done. Edges are placed when they are
   needed. */
static DEM__NOINLINE int dem__find_edge_points(const dem__side *a, const dem__side *b, int apart,
                                               dem__convex_point *out, int n) {
    const double radii = a->shape->radius + b->shape->radius, window = DEM__WINDOW * radii;
    const double part = dem__part_of(a->shape->springs > b->shape->springs ? a->shape : b->shape);
    uint8_t is_placed[DEM_EDGES_MAX], other[DEM_EDGES_MAX];
    dem__placed_edge p, edge[DEM_EDGES_MAX]; /* of a, and all of b: a second table would make the stack frame too
                                                large */
    dem__edge_list of_a, of_b;
    dem__list_near_edges(a, &of_a), dem__list_near_edges(b, &of_b);
    const int a_first = of_a.n <= of_b.n, boxes = a->shape->is_box && b->shape->is_box;
    dem__keep_edges(a_first ? a : b, a_first ? b : a, window, a_first ? &of_a : &of_b);
    if (of_a.n == 0 || of_b.n == 0) return n;
    dem__find_sides(a_first ? b : a, a_first ? &of_b : &of_a);
    memset(is_placed, 0, (size_t)of_b.n);
    for (int e = 0; e < of_a.n; e++) {
        int others = 0;
        for (int f = 0; f < of_b.n; f++) other[others] = (uint8_t)f, others += !(of_a.sides[e] & of_b.sides[f]);
        if (others > 0) dem__place_edge(a, of_a.number[e], apart, &p);
        if (others > 0 && !boxes) dem__find_near_part(a, of_a.number[e], &p);
        for (int m = 0; m < others && n + 5 <= DEM__POINTS_MAX; m++) {
            const int f = other[m];
            if (!is_placed[f]) dem__place_edge(b, of_b.number[f], apart, &edge[f]);
            if (!is_placed[f] && !boxes) dem__find_near_part(b, of_b.number[f], &edge[f]);
            is_placed[f] = 1;
            const dem__placed_edge *q = &edge[f];
            const int32_t key = 2 * DEM_CORNERS_MAX + 5 * (p.number * DEM_EDGES_MAX + q->number);
            if (boxes || !dem__are_apart(&p, q, window)) n += dem__cross_edges(&p, q, radii, apart, part, key, &out[n]);
        }
    }
    return n;
}

/* Finds the points of a pair whose nearest direction is known, at most DEM__POINTS_MAX, sorted by key. Returns how
   many. If a core is a point, only its own corner counts; otherwise it would be counted twice. */
static DEM__NOINLINE int dem__find_points(const dem_convex *a, const dem__placed *pa, const dem_convex *b,
                                          const dem__placed *pb, dem_vec normal, dem__convex_point *out) {
    dem__side sa, sb;
    dem_vec seen_a[DEM_CORNERS_MAX], seen_b[DEM_CORNERS_MAX];
    const double radii = DEM__WINDOW * (a->radius + b->radius);
    double low_a, high_a, low_b, high_b;
    int n = 0;
    sa.seen = seen_a, sb.seen = seen_b, sa.shape = a, sa.place = pa, sb.shape = b, sb.place = pb;
    dem__find_heights(&sa, normal, &low_a, &high_a);
    dem__find_heights(&sb, normal, &low_b, &high_b);
    if (!(low_a - high_b < radii)) return 0;
    dem__choose_corners(&sa, high_b + radii, 1.0);
    dem__choose_corners(&sb, radii - low_a, -1.0);
    dem__see_corners(&sa, &sb), dem__see_corners(&sb, &sa);
    if (b->corners > 1 || a->corners == 1) n = dem__find_corner_points(&sa, &sb, 0, out, n);
    if (a->corners > 1) n = dem__find_corner_points(&sb, &sa, DEM_CORNERS_MAX, out, n);
    return dem__find_edge_points(&sa, &sb, low_a > high_b, out, n);
}
