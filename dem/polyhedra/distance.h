/* Distances between placed convex cores, by Gilbert, Johnson & Keerthi (1988). Promises: a separation never exceeds the
   true one, however few iterations were made. A point (1 corner), a segment (2 corners, 1 edge) and a triangle (3
   corners, 3 edges, 2 faces) are cores like any other. */
#pragma once
#include "shape.h"

DEM_INLINE dem_vec dem__from_core_frame(const dem__placed *p, dem_vec v) {
    return dem__add(dem__scale(v.x, p->axis[0]), dem__plus(dem__scale(v.y, p->axis[1]), v.z, p->axis[2]));
}
DEM_INLINE dem_vec dem__into_core(const dem__placed *p, dem_vec v) {
    return dem_vec3(dem__dot(v, p->axis[0]), dem__dot(v, p->axis[1]), dem__dot(v, p->axis[2]));
}
DEM_INLINE dem_vec dem__corner_at(const dem_convex *s, const dem__placed *p, int k) {
    return dem__add(p->x, dem__from_core_frame(p, dem__point(s->corner[k])));
}

/* Returns the corner of a core that is farthest along u, in the core's own frame. */
DEM_INLINE int dem__farthest(const dem_convex *s, dem_vec u) {
    int best = 0;
    double most = dem__dot(u, dem__point(s->corner[0]));
    for (int k = 1; k < s->corners; k++) {
        const double along = dem__dot(u, dem__point(s->corner[k]));
        best = along > most ? k : best, most = along > most ? along : most;
    }
    return best;
}

/* A simplex of corners of the difference of two cores: the corners of each, their positions, and their weights in the
   nearest point. */
typedef struct dem__simplex {
    int n;
    uint8_t a[4], b[4];
    dem_vec at[4];
    double part[4];
} dem__simplex;

DEM_INLINE void dem__keep_corners(dem__simplex *s, int n, const int *kept, const double *part) {
    for (int k = 0; k < n; k++) { /* `kept` ascends */
        s->a[k] = s->a[kept[k]], s->b[k] = s->b[kept[k]], s->at[k] = s->at[kept[k]];
        s->part[k] = part[k];
    }
    s->n = n;
}

/* Returns the point of segment i, j of a simplex that is nearest to the origin. Keeps the corners between which it
   lies. */
static inline dem_vec dem__near_segment(dem__simplex *s, int i, int j) {
    const dem_vec p = s->at[i], u = dem__sub(s->at[j], p);
    const double along = -dem__dot(p, u), length = dem__dot(u, u);
    const int both[2] = {i < j ? i : j, i < j ? j : i};
    if (!(along > 0.0) || !(along < length)) {
        const int one = along > 0.0 ? j : i;
        const double whole = 1.0;
        dem__keep_corners(s, 1, &one, &whole);
        return s->at[0];
    }
    const double t = along / length, part[2] = {i < j ? 1.0 - t : t, i < j ? t : 1.0 - t};
    dem__keep_corners(s, 2, both, part);
    return dem__plus(p, t, u);
}

/* Does the same for triangle i < j < k (Ericson 2005, section 5.1.5). */
static inline dem_vec dem__near_triangle(dem__simplex *s, int i, int j, int k) {
    const dem_vec a = s->at[i], ab = dem__sub(s->at[j], a), ac = dem__sub(s->at[k], a);
    const double d1 = -dem__dot(ab, a), d2 = -dem__dot(ac, a);
    const double d3 = -dem__dot(ab, s->at[j]), d4 = -dem__dot(ac, s->at[j]), d5 = -dem__dot(ab, s->at[k]),
                 d6 = -dem__dot(ac, s->at[k]);
    const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4, all = va + vb + vc;
    if (!(all > 0.0) || vc <= 0.0 || vb <= 0.0 || va <= 0.0) { /* on the border: the nearest point of three segments */
        const int pair[3][2] = {{i, j}, {i, k}, {j, k}};
        dem__simplex best = *s;
        dem_vec least = a;
        double shortest = HUGE_VAL;
        for (int q = 0; q < 3; q++) {
            dem__simplex side = *s;
            const dem_vec v = dem__near_segment(&side, pair[q][0], pair[q][1]);
            if (dem__dot(v, v) < shortest) shortest = dem__dot(v, v), least = v, best = side;
        }
        *s = best;
        return least;
    }
    const int kept[3] = {i, j, k};
    const double part[3] = {va / all, vb / all, vc / all};
    dem__keep_corners(s, 3, kept, part);
    return dem__plus(dem__plus(a, part[1], ab), part[2], ac);
}

/* Does the same for a tetrahedron. Returns 0 where it contains the origin. */
static inline dem_vec dem__near_tetrahedron(dem__simplex *s) {
    const int face[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
    dem__simplex best = *s;
    dem_vec least = dem_vec3(0.0, 0.0, 0.0);
    double shortest = HUGE_VAL;
    for (int f = 0; f < 4; f++) {
        const dem_vec p = s->at[face[f][0]],
                      n = dem__cross(dem__sub(s->at[face[f][1]], p), dem__sub(s->at[face[f][2]], p));
        const double inner = dem__dot(n, dem__sub(s->at[face[f][3]], p)), origin = -dem__dot(n, p);
        if (inner * origin > 0.0) continue; /* on the side of the fourth corner */
        dem__simplex side = *s;
        const dem_vec v = dem__near_triangle(&side, face[f][0], face[f][1], face[f][2]);
        if (dem__dot(v, v) < shortest) shortest = dem__dot(v, v), least = v, best = side;
    }
    *s = best;
    return least;
}

static inline dem_vec dem__near_simplex(dem__simplex *s) {
    s->part[0] = 1.0;
    if (s->n == 1) return s->at[0];
    if (s->n == 2) return dem__near_segment(s, 0, 1);
    return s->n == 3 ? dem__near_triangle(s, 0, 1, 2) : dem__near_tetrahedron(s);
}

/* Distance of two cores. */
typedef struct dem__gap_of_cores {
    dem_vec normal;      /* from b to a, a unit vector */
    double separation;   /* their distance along it, or a lower limit of it; negative where they overlap */
    dem_vec at_a, at_b;  /* the points nearest to each other, if they do not overlap */
    int overlap, rounds; /* whether they overlap; number of iterations */
} dem__gap_of_cores;

DEM_INLINE void dem__add_corners(dem__simplex *s, const dem_convex *a, const dem__placed *pa, int i,
                                 const dem_convex *b, const dem__placed *pb, int j) {
    const int k = s->n++;
    s->a[k] = (uint8_t)i, s->b[k] = (uint8_t)j;
    s->at[k] = dem__sub(dem__corner_at(a, pa, i), dem__corner_at(b, pb, j));
}

/* Starts with the corners of the last test, or with those that face each other. */
static inline void dem__begin_simplex(dem__simplex *s, const dem_convex *a, const dem__placed *pa, const dem_convex *b,
                                      const dem__placed *pb, const dem__nearest_cache *cache) {
    s->n = 0;
    for (int k = 0; cache && k < cache->n; k++) dem__add_corners(s, a, pa, cache->a[k], b, pb, cache->b[k]);
    if (s->n > 0) return;
    const dem_vec d = dem__sub(pa->x, pb->x);
    dem__add_corners(s, a, pa, dem__farthest(a, dem__into_core(pa, dem__scale(-1.0, d))), b, pb,
                     dem__farthest(b, dem__into_core(pb, d)));
}

/* Returns how far a core extends from its centre in the direction n [m]. */
DEM_INLINE double dem__reach_along(const dem_convex *s, const dem__placed *p, dem_vec n) {
    const dem_vec u = dem__into_core(p, n);
    if (s->is_box) return fabs(u.x) * s->half.x + fabs(u.y) * s->half.y + fabs(u.z) * s->half.z;
    return dem__dot(u, dem__point(s->corner[dem__farthest(s, u)]));
}
/* Returns a lower limit of the distance of two cores [m]: the distance along n, a unit vector from b to a. A negative
   value says nothing, because they may be apart in another direction. */
DEM_INLINE double dem__apart_along(const dem_convex *a, const dem__placed *pa, const dem_convex *b,
                                   const dem__placed *pb, dem_vec n) {
    if (n.x == 0.0 && n.y == 0.0 && n.z == 0.0) return -HUGE_VAL;
    return dem__dot(n, dem__sub(pa->x, pb->x)) - dem__reach_along(a, pa, dem__scale(-1.0, n)) -
           dem__reach_along(b, pb, n);
}
/* Two boxes in the frame of the first one: the vector from the centre of b to that of a, and the axes of b. */
typedef struct dem__two_boxes {
    const dem_convex *a, *b;
    double from[3], turn[3][3],
        size[3][3]; /* along a's axes; turn[i][m]: cosine between a's axis i and b's axis m; size: its absolute value */
} dem__two_boxes;

/* Finds the axis k < 3 of a, or k - 3 of b, along which two boxes are farthest apart. Returns how far, as
   dem__apart_along does. along: component of the distance along the axis. */
static inline double dem__apart_along_faces(const dem__two_boxes *q, int *k, double *along) {
    double most = -HUGE_VAL;
    for (int n = 0; n < 6; n++) {
        const int i = n % 3, of_a = n < 3;
        const double *u = q->size[i];
        const dem_vec half = of_a ? q->b->half : q->a->half;
        const double d =
            of_a ? q->from[i] : q->from[0] * q->turn[0][i] + q->from[1] * q->turn[1][i] + q->from[2] * q->turn[2][i];
        const double reach = of_a ? half.x * u[0] + half.y * u[1] + half.z * u[2]
                                  : half.x * q->size[0][i] + half.y * q->size[1][i] + half.z * q->size[2][i];
        const double apart = fabs(d) - dem_axis(of_a ? q->a->half : q->b->half, i) - reach;
        if (apart > most) most = apart, *k = n, *along = d;
    }
    return most;
}
/* Does the same for the products of an axis of a and one of b: k = 3 i + m. */
static inline double dem__apart_along_edges(const dem__two_boxes *q, int *k, double *along) {
    double most = -HUGE_VAL;
    for (int n = 0; n < 9; n++) {
        const int i = n / 3, m = n % 3, j = (i + 1) % 3, l = (i + 2) % 3, r = (m + 1) % 3, s = (m + 2) % 3;
        const double square = 1.0 - q->turn[i][m] * q->turn[i][m];
        const double d = q->from[l] * q->turn[j][m] - q->from[j] * q->turn[l][m];
        const double apart = fabs(d) - dem_axis(q->a->half, j) * q->size[l][m] -
                             dem_axis(q->a->half, l) * q->size[j][m] - dem_axis(q->b->half, r) * q->size[i][s] -
                             dem_axis(q->b->half, s) * q->size[i][r];
        if (!(apart > 0.0) || !(square > 1e-6)) continue;
        const double distance = apart / sqrt(square);
        if (distance > most) most = distance, *k = n, *along = d;
    }
    return most;
}

/* Looks for a direction along which two boxes are farther apart than `enough`, a unit vector from b to a, among the
   normals of faces, then the products of edges (separating axes). Returns how far, as dem__apart_along does. If that is
   not enough, the direction is not set. */
static inline double dem__part_boxes(const dem_convex *a, const dem__placed *pa, const dem_convex *b,
                                     const dem__placed *pb, double enough, dem_vec *normal) {
    dem__two_boxes q;
    int k = 0;
    double along = 0.0;
    const dem_vec d = dem__into_core(pa, dem__sub(pa->x, pb->x));
    q.a = a, q.b = b;
    q.from[0] = d.x, q.from[1] = d.y, q.from[2] = d.z;
    for (int i = 0; i < 3; i++) {
        for (int m = 0; m < 3; m++)
            q.turn[i][m] = dem__dot(pa->axis[i], pb->axis[m]), q.size[i][m] = fabs(q.turn[i][m]);
    }
    double apart = dem__apart_along_faces(&q, &k, &along);
    dem_vec n = k < 3 ? pa->axis[k] : pb->axis[k - 3];
    if (!(apart > enough)) {
        apart = dem__apart_along_edges(&q, &k, &along);
        if (!(apart > enough)) return apart;
        n = dem__cross(pa->axis[k / 3], pb->axis[k % 3]);
        n = dem__scale(1.0 / dem__length(n), n);
    }
    *normal = along < 0.0 ? dem__scale(-1.0, n) : n;
    return apart;
}

/* Finds the direction of least overlap of two overlapping cores, among the normals of faces and the products of edges
   (separating axis theorem). */
static inline void dem__least_overlap(const dem_convex *a, const dem__placed *pa, const dem_convex *b,
                                      const dem__placed *pb, dem__gap_of_cores *gap) {
    const int axes = a->faces + b->faces + a->edges * b->edges;
    gap->separation = -HUGE_VAL, gap->normal = dem_vec3(0.0, 0.0, 1.0);
    for (int m = 0; m < axes; m++) {
        dem_vec n;
        if (m < a->faces) n = dem__scale(-1.0, dem__from_core_frame(pa, dem__point(a->plane[m])));
        else if (m < a->faces + b->faces) n = dem__from_core_frame(pb, dem__point(b->plane[m - a->faces]));
        else {
            const int e = (m - a->faces - b->faces) / b->edges, f = (m - a->faces - b->faces) % b->edges;
            const dem_vec u = dem__sub(dem__corner_at(a, pa, a->edge[e][1]), dem__corner_at(a, pa, a->edge[e][0]));
            const dem_vec v = dem__sub(dem__corner_at(b, pb, b->edge[f][1]), dem__corner_at(b, pb, b->edge[f][0]));
            n = dem__cross(u, v);
            const double size = dem__length(n);
            if (!(size > 1e-6 * dem__length(u) * dem__length(v))) continue;
            n = dem__scale((dem__dot(n, dem__sub(pa->x, pb->x)) < 0.0 ? -1.0 : 1.0) / size, n);
        }
        const dem_vec in_a = dem__scale(-1.0, dem__into_core(pa, n)), in_b = dem__into_core(pb, n);
        const double low = dem__dot(n, pa->x) - dem__dot(in_a, dem__point(a->corner[dem__farthest(a, in_a)])),
                     high = dem__dot(n, pb->x) + dem__dot(in_b, dem__point(b->corner[dem__farthest(b, in_b)]));
        if (low - high > gap->separation) gap->separation = low - high, gap->normal = n;
    }
}

/* Computes the points of the two cores that are nearest to each other, from a simplex. */
static inline void dem__nearest_points(const dem__simplex *s, const dem_convex *a, const dem__placed *pa,
                                       const dem_convex *b, const dem__placed *pb, dem__gap_of_cores *gap) {
    gap->at_a = gap->at_b = dem_vec3(0.0, 0.0, 0.0);
    for (int k = 0; k < s->n; k++) {
        gap->at_a = dem__plus(gap->at_a, s->part[k], dem__corner_at(a, pa, s->a[k]));
        gap->at_b = dem__plus(gap->at_b, s->part[k], dem__corner_at(b, pb, s->b[k]));
    }
}

/* A direction is good enough to find the points of two cores if their distance along it is at least this share of the
   radii. */
#define DEM__GOOD_AXIS 0.9

/* Finds distance and normal of two cores, to 1e-7 of the distance. Stops as soon as they are certainly farther apart
   than `enough`, or certainly nearer and apart along a good direction. cache: of this pair, read and written, or
   NULL. */
static inline void dem__find_gap(const dem_convex *a, const dem__placed *pa, const dem_convex *b, const dem__placed *pb,
                                 double enough, dem__nearest_cache *cache, dem__gap_of_cores *gap) {
    dem__simplex s;
    const double tiny = 1e-12 * (a->reach + b->reach);
    gap->separation = -HUGE_VAL, gap->overlap = 0;
    dem__begin_simplex(&s, a, pa, b, pb, cache);
    for (gap->rounds = 0; gap->rounds < 32; gap->rounds++) {
        const dem_vec v = dem__near_simplex(&s);
        const double distance = dem__length(v);
        if (!(distance > tiny)) {
            gap->overlap = 1;
            break;
        }
        const dem_vec n = dem__scale(1.0 / distance, v);
        const int i = dem__farthest(a, dem__into_core(pa, dem__scale(-1.0, n))),
                  j = dem__farthest(b, dem__into_core(pb, n));
        const double along = dem__dot(n, dem__sub(dem__corner_at(a, pa, i), dem__corner_at(b, pb, j)));
        int known = s.n == 4;
        if (along > gap->separation) gap->separation = along, gap->normal = n;
        for (int k = 0; k < s.n; k++) known |= s.a[k] == i && s.b[k] == j;
        if (known || along > enough || distance - along <= 1e-7 * distance) break;
        if (distance < enough && along > DEM__GOOD_AXIS * enough) break;
        dem__add_corners(&s, a, pa, i, b, pb, j);
    }
    if (cache) {
        cache->n = (uint8_t)(s.n < 4 ? s.n : 0);
        for (int k = 0; k < cache->n; k++) cache->a[k] = s.a[k], cache->b[k] = s.b[k];
    }
    if (gap->overlap) dem__least_overlap(a, pa, b, pb, gap);
    else dem__nearest_points(&s, a, pa, b, pb, gap);
}

/* Makes a core from a segment, or a triangle. Its centre is the first corner; its axes are the world's. */
static inline void dem__segment_core(dem_convex *s, dem__placed *p, dem_vec from, dem_vec to, double radius) {
    const dem_vec u = dem__sub(to, from);
    memset(s, 0, sizeof *s);
    p->x = from, p->axis[0] = dem_vec3(1.0, 0.0, 0.0), p->axis[1] = dem_vec3(0.0, 1.0, 0.0),
    p->axis[2] = dem_vec3(0.0, 0.0, 1.0);
    s->corners = 2, s->edges = 1, s->radius = radius, s->reach = dem__length(u) + radius;
    s->corner[1][0] = u.x, s->corner[1][1] = u.y, s->corner[1][2] = u.z;
    s->edge[0][1] = 1;
}
static inline void dem__triangle_core(dem_convex *s, dem__placed *p, dem_vec a, dem_vec b, dem_vec c) {
    const dem_vec u = dem__sub(b, a), v = dem__sub(c, a), n = dem__cross(u, v);
    dem__segment_core(s, p, a, b, 0.0);
    const double area = dem__length(n), along = dem__length(v);
    s->corners = s->edges = 3, s->faces = 2, s->reach = s->reach > along ? s->reach : along;
    s->corner[2][0] = v.x, s->corner[2][1] = v.y, s->corner[2][2] = v.z;
    for (int k = 0; k < 3; k++) {
        s->edge[k][0] = (uint8_t)k, s->edge[k][1] = (uint8_t)((k + 1) % 3), s->edge_face[k][1] = 1;
        s->face_corner[k] = (uint8_t)k, s->face_corner[3 + k] = (uint8_t)(2 - k);
        s->plane[0][k] = dem_axis(n, k) / area, s->plane[1][k] = -s->plane[0][k];
    }
    s->face_start[1] = 3, s->face_start[2] = 6;
}
/* Makes a core from a point: the centre of a sphere. */
static inline void dem__point_core(dem_convex *s, dem__placed *p, dem_vec x, double radius) {
    dem__segment_core(s, p, x, x, radius);
    s->corners = 1, s->edges = 0;
}
