/* The core of a hull of many corners: eroded by the radius of the rounding, and reduced to as many corners as a shape
   may have. Reads a hull; makes a shape. Promises: faces on which a face of the core lies stay where they are; the
   deviation reported is the Hausdorff distance from the eroded hull, up to rounding. */
#pragma once
#include "distance.h"
#include "hull.h"

#define DEM__ERODED_MAX 1000 /* corners of a hull that are eroded at most: the farthest ones of more */

/* Corners of a core before its reduction, the planes of the hull, and how far the core is behind them. */
typedef struct dem__cloud {
    ptrdiff_t points, planes;
    double *point;      /* [points][3] [m] */
    double (*plane)[4]; /* [planes] [m]: outward normal, offset */
    double inwards;     /* [m] */
} dem__cloud;

/* Returns the point of a cloud that is farthest along u. */
static inline dem_vec dem__farthest_of(const double *point, ptrdiff_t n, dem_vec u) {
    ptrdiff_t best = 0;
    double most = dem__dot(u, dem__point(point));
    for (ptrdiff_t k = 1; k < n; k++) {
        const double along = dem__dot(u, dem__point(point + 3 * k));
        if (along > most) most = along, best = k;
    }
    return dem__point(point + 3 * best);
}

/* Returns the distance of x from the hull of n points (Gilbert, Johnson & Keerthi 1988), to a relative error of 1e-6 or
   to `tiny`; 0 inside. */
static inline double dem__from_cloud(const double *point, ptrdiff_t n, dem_vec x, double tiny) {
    dem__simplex s;
    double low = 0.0;
    memset(&s, 0, sizeof s);
    s.n = 1, s.at[0] = dem__sub(x, dem__farthest_of(point, n, x));
    for (int round = 0; round < 64; round++) {
        const dem_vec v = dem__near_simplex(&s);
        const double distance = dem__length(v);
        if (!(distance > tiny)) return 0.0;
        const dem_vec u = dem__scale(1.0 / distance, v), at = dem__sub(x, dem__farthest_of(point, n, u));
        const double along = dem__dot(u, at);
        low = along > low ? along : low;
        if (s.n == 4 || distance - low <= 1e-6 * distance + tiny) return low;
        s.at[s.n++] = at;
    }
    return low;
}

/* ---- faces of a hull ---- */

/* Adds the plane of triangle f with its normal n, and assigns it to all adjoining triangles that lie in it. */
static inline void dem__spread_plane(const dem__hull_builder *b, const double *y, double flat, int32_t f, dem_vec n,
                                     dem__cloud *hull, int32_t *number) {
    const double offset = dem__dot(n, dem__point(y + 3 * b->facet[f].corner[0]));
    double *plane = hull->plane[hull->planes];
    int32_t waiting = 1;
    b->list[0] = f, number[f] = (int32_t)hull->planes;
    for (int32_t at = 0; at < waiting; at++) {
        const dem__hull_face *facet = &b->facet[b->list[at]];
        for (int k = 0; k < 3; k++) {
            const int32_t other = facet->beside[k];
            int in = number[other] < 0 && dem__dot(n, b->facet[other].normal) > 0.0;
            for (int q = 0; q < 3 && in; q++)
                in = fabs(dem__dot(n, dem__point(y + 3 * b->facet[other].corner[q])) - offset) <= flat;
            if (in) number[other] = (int32_t)hull->planes, b->list[waiting++] = other;
        }
    }
    plane[0] = n.x, plane[1] = n.y, plane[2] = n.z, plane[3] = offset;
    hull->planes++;
}

/* Finds the planes of a hull's faces. Triangles in one plane, up to `flat`, get that of a large one. y: the hull's
   points. number: index of a triangle's plane, or -1. */
static inline void dem__find_planes(const dem__hull_builder *b, const double *y, double flat, dem__cloud *hull,
                                    int32_t *number) {
    double largest = 0.0;
    hull->planes = 0;
    for (int32_t f = 0; f < b->facets; f++) {
        const int32_t *c = b->facet[f].corner;
        number[f] = -1;
        if (!b->facet[f].alive) continue;
        const double area = dem__length(dem__cross(dem__sub(dem__point(y + 3 * c[1]), dem__point(y + 3 * c[0])),
                                                   dem__sub(dem__point(y + 3 * c[2]), dem__point(y + 3 * c[0]))));
        largest = area > largest ? area : largest;
    }
    for (double least = 0.25 * largest; least > 1e-13 * largest; least *= 0.25) { /* large ones first */
        for (int32_t f = 0; f < b->facets; f++) {
            const int32_t *c = b->facet[f].corner;
            if (!b->facet[f].alive || number[f] >= 0) continue;
            const dem_vec p = dem__point(y + 3 * c[0]), u = dem__sub(dem__point(y + 3 * c[1]), p),
                          v = dem__sub(dem__point(y + 3 * c[2]), p), cross = dem__cross(u, v);
            const double area = dem__length(cross), longest = dem__length(u) + dem__length(v);
            if (!(area > least) || !(area > flat * longest)) continue; /* slivers have no direction */
            dem__spread_plane(b, y, flat, f, dem__scale(1.0 / area, cross), hull, number);
        }
    }
}

/* Returns the smallest distance between a face and the point opposite to it. */
static inline double dem__least_width_of(const dem__cloud *hull, const double *y, ptrdiff_t n) {
    double least = HUGE_VAL;
    for (ptrdiff_t f = 0; f < hull->planes; f++) {
        const dem_vec u = dem__point(hull->plane[f]);
        const double depth = hull->plane[f][3] - dem__dot(u, dem__farthest_of(y, n, dem__scale(-1.0, u)));
        least = depth < least ? depth : least;
    }
    return least;
}

/* Finds a point far inside planes that have moved inwards. Returns its least depth [m]; there is none if that is not
   above 0. */
static inline double dem__inner_point(const dem__cloud *hull, dem_vec *point) {
    dem_vec x = dem_vec3(0.0, 0.0, 0.0);
    double best = -HUGE_VAL, step = 0.0;
    *point = x;
    for (int round = 0; round < 200; round++) {
        double least = HUGE_VAL;
        ptrdiff_t nearest = 0;
        for (ptrdiff_t f = 0; f < hull->planes; f++) {
            const double depth = hull->plane[f][3] - hull->inwards - dem__dot(dem__point(hull->plane[f]), x);
            if (depth < least) least = depth, nearest = f;
        }
        if (least > best) best = least, *point = x;
        if (round == 0) step = hull->plane[nearest][3];
        x = dem__plus(x, -step / (double)(round + 2), dem__point(hull->plane[nearest]));
    }
    return best;
}

/* ---- erosion ---- */

/* Finds the corners of the core: triangles of the hull of the dual points of its planes. dual: a builder for them;
   work: [planes][3]. Returns 0 if nothing is left. */
static inline int dem__erode_planes(dem__hull_builder *dual, double flat, double *work, dem__cloud *core) {
    double(*plane)[4] = core->plane;
    dem_vec middle;
    core->points = 0;
    if (!(dem__inner_point(core, &middle) > 2.0 * flat)) return 0;
    for (ptrdiff_t f = 0; f < core->planes; f++) {
        const dem_vec n = dem__point(plane[f]);
        const double depth = plane[f][3] - core->inwards - dem__dot(n, middle);
        work[3 * f] = n.x / depth, work[3 * f + 1] = n.y / depth, work[3 * f + 2] = n.z / depth;
    }
    if (dem__build_hull(dual, work, DEM__HULL_MAX, 0.0, 0.0) != DEM__HULL_OK) return 0;
    for (int32_t f = 0; f < dual->facets; f++) {
        const int32_t *c = dual->facet[f].corner;
        dem_vec x;
        if (!dual->facet[f].alive || dem__meet(plane[c[0]], plane[c[1]], plane[c[2]], core->inwards, 1e-9, &x) == 0.0)
            continue;
        ptrdiff_t k = 0;
        while (k < core->planes && dem__dot(dem__point(plane[k]), x) <= plane[k][3] - core->inwards + flat) k++;
        if (k < core->planes) continue;
        double *at = core->point + 3 * core->points++;
        at[0] = x.x, at[1] = x.y, at[2] = x.z;
    }
    return core->points >= 4;
}

/* ---- reduction ---- */

/* The hull of a few corners of a core. */
typedef struct dem__few {
    int corners, facets;
    int32_t from[DEM_CORNERS_MAX]; /* their indices among the points */
    uint8_t facet[DEM_FACES_MAX][3];
    dem_vec normal[DEM_FACES_MAX];
    double behind[DEM_FACES_MAX]; /* how far the core is in front of a facet [m] */
} dem__few;

/* Copies the hull from a builder. */
static inline void dem__get_few(const dem__hull_builder *b, const dem__cloud *core, dem__few *few) {
    few->corners = few->facets = 0;
    for (int32_t f = 0; f < b->facets; f++) {
        if (!b->facet[f].alive) continue;
        dem_vec x[3];
        for (int k = 0; k < 3; k++) {
            int q = 0;
            while (q < few->corners && few->from[q] != b->facet[f].corner[k]) q++;
            if (q == few->corners) few->from[few->corners++] = b->facet[f].corner[k];
            few->facet[few->facets][k] = (uint8_t)q;
            x[k] = dem__point(core->point + 3 * few->from[q]);
        }
        const dem_vec n = dem__cross(dem__sub(x[1], x[0]), dem__sub(x[2], x[0]));
        const double size = dem__length(n);
        if (!(size > 0.0)) continue;
        const dem_vec u = dem__scale(1.0 / size, n);
        few->normal[few->facets] = u;
        few->behind[few->facets++] = dem__dot(u, dem__sub(dem__farthest_of(core->point, core->points, u), x[0]));
    }
}

/* Solves m x = b, for a positive definite matrix. */
static inline dem_vec dem__solve_three(double (*m)[3], dem_vec b) {
    const dem_vec r = dem__point(m[0]), s = dem__point(m[1]), t = dem__point(m[2]);
    const dem_vec st = dem__cross(s, t), tr = dem__cross(t, r), rs = dem__cross(r, s);
    return dem__scale(1.0 / dem__dot(r, st), dem__plus(dem__plus(dem__scale(b.x, st), b.y, tr), b.z, rs));
}

/* Returns how a corner of the reduced hull moves so that its facets move outwards by a share of their distance from the
   core. Facets that lie in a face of the core stay. flat: [m] */
static inline dem_vec dem__way_out(const dem__few *few, int corner, double part, double flat) {
    double m[3][3] = {{1e-3, 0, 0}, {0, 1e-3, 0}, {0, 0, 1e-3}};
    dem_vec b = dem_vec3(0.0, 0.0, 0.0), kept[3];
    int keeps = 0;
    for (int f = 0; f < few->facets; f++) {
        const dem_vec n = few->normal[f];
        if (few->facet[f][0] != corner && few->facet[f][1] != corner && few->facet[f][2] != corner) continue;
        if (few->behind[f] <= flat) {
            dem_vec rest = n;
            for (int k = 0; k < keeps; k++) rest = dem__plus(rest, -dem__dot(rest, kept[k]), kept[k]);
            const double size = dem__length(rest);
            if (keeps < 3 && size > 1e-3) kept[keeps++] = dem__scale(1.0 / size, rest);
            continue;
        }
        b = dem__plus(b, part * few->behind[f], n);
        for (int p = 0; p < 3; p++)
            for (int q = 0; q < 3; q++) m[p][q] += dem_axis(n, p) * dem_axis(n, q);
    }
    dem_vec way = dem__solve_three(m, b);
    for (int k = 0; k < keeps; k++) way = dem__plus(way, -dem__dot(way, kept[k]), kept[k]);
    return way;
}

/* Returns the Hausdorff distance between the hull of a shape's corners and a core. Stops at `enough`. */
static inline double dem__deviation_from(const dem_convex *s, const dem__cloud *core, double enough, double tiny) {
    double most = 0.0;
    for (int k = 0; k < s->corners && most < enough; k++) {
        const double away = dem__from_cloud(core->point, core->points, dem__point(s->corner[k]), tiny);
        most = away > most ? away : most;
    }
    for (ptrdiff_t k = 0; k < core->points && most < enough; k++) {
        const double away = dem__from_cloud(s->corner[0], s->corners, dem__point(core->point + 3 * k), tiny);
        most = away > most ? away : most;
    }
    return most;
}

/* Takes a trial if it is a polyhedron, and closer to the core than the best one so far. */
static inline void dem__try_core(const dem__cloud *core, double flat, dem_convex *trial, dem_convex *best) {
    if (dem__find_surface(trial, 0.1 * flat) != NULL) return;
    trial->deviation = dem__deviation_from(trial, core, best->deviation, 0.01 * flat);
    if (trial->deviation < best->deviation) *best = *trial;
}

/* Makes a core of at most `most` corners: the farthest points, moved outwards by several shares, of which the best one
   is taken. s: in, the shape without its core. Returns 0 if no trial is a polyhedron. */
static inline int dem__reduce(dem__hull_builder *b, const dem__cloud *core, int most, double flat, dem_convex *s) {
    dem__few few;
    dem_convex trial = *s;
    if (!dem__build_few(b, core->point, most, flat)) return 0;
    dem__get_few(b, core, &few);
    s->deviation = HUGE_VAL;
    for (int share = 0; share <= 8 && s->deviation > flat; share++) {
        trial.corners = few.corners;
        for (int k = 0; k < few.corners; k++) {
            const dem_vec x =
                dem__add(dem__point(core->point + 3 * few.from[k]), dem__way_out(&few, k, 0.1 * (double)share, flat));
            trial.corner[k][0] = x.x, trial.corner[k][1] = x.y, trial.corner[k][2] = x.z;
        }
        dem__try_core(core, flat, &trial, s);
    }
    return s->deviation < HUGE_VAL;
}
