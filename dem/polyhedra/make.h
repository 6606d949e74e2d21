/* Making convex polyhedra: from corners, from a mesh, from the hull of any points. */
#pragma once
#include "core.h"

/* Working memory for making a shape from a hull. */
typedef struct dem__hull_work {
    dem_allocator allocator;
    dem__hull_builder given, far, dual, few; /* hulls of the points; of its corners; of its planes; of the core */
    void *block;
    size_t bytes;
    double *y;              /* [corners][3]: of the hull, about its centroid, along its principal axes [m] */
    int32_t *number, *from; /* index of a triangle's plane; of a corner among the points */
    double *work;
    dem__cloud core;
    ptrdiff_t corners;
} dem__hull_work;

static inline void dem__end_hull_work(dem__hull_work *h) {
    dem__end_hull(&h->given), dem__end_hull(&h->far), dem__end_hull(&h->dual), dem__end_hull(&h->few);
    if (h->block) h->allocator.fn(h->allocator.user, h->block, h->bytes, 0);
}

/* Allocates the arrays for m corners. Returns 0 when out of memory. */
static inline int dem__begin_hull_work(dem__hull_work *h, ptrdiff_t m) {
    const size_t corners = (size_t)m, few = corners < DEM__ERODED_MAX ? corners : DEM__ERODED_MAX, planes = 2 * few,
                 points = 2 * planes + 8, facets = 2 * corners + 8;
    const size_t doubles = 3 * corners + 7 * planes + 3 * points, integers = facets + corners;
    h->bytes = doubles * sizeof(double) + integers * sizeof(int32_t);
    h->block = h->allocator.fn(h->allocator.user, NULL, 0, h->bytes);
    if (!h->block) return 0;
    dem__cloud *core = &h->core;
    h->y = (double *)h->block, core->plane = (double(*)[4])(void *)(h->y + 3 * corners);
    h->work = h->y + 3 * corners + 4 * planes, core->point = h->work + 3 * planes;
    h->number = (int32_t *)(void *)(core->point + 3 * points), h->from = h->number + facets;
    return dem__begin_hull(&h->far, &h->allocator, m);
}

/* Sums up the moments of the hull's triangles about `middle`. */
static inline void dem__integrate_hull(const dem__hull_builder *b, const double *x, dem_vec middle,
                                       dem__moments *bulk) {
    memset(bulk, 0, sizeof *bulk);
    for (int32_t f = 0; f < b->facets; f++) {
        double corner[3][3];
        if (!b->facet[f].alive) continue;
        for (int k = 0; k < 9; k++)
            corner[k / 3][k % 3] = x[3 * b->facet[f].corner[k / 3] + k % 3] - dem_axis(middle, k % 3);
        dem__add_triangle(bulk, corner[0], corner[1], corner[2]);
    }
}

/* Finds the hull of n points: volume, centroid, moments, axes, and its corners. Returns NULL, or what is wrong. */
static inline const char *dem__measure_hull(dem__hull_work *h, dem_convex *s, ptrdiff_t n, const double *x,
                                            dem_status *status) {
    const double flat = DEM__FLAT * dem__half_size(x, (int)n);
    dem__moments bulk;
    dem_vec c;
    *status = DEM_OUT_OF_MEMORY;
    if (!dem__begin_hull(&h->given, &h->allocator, n)) return "out of memory";
    *status = DEM_BAD_ARGUMENT;
    if (!(flat > 0.0)) return "the corners lie in one point";
    const int built = dem__build_hull(&h->given, x, DEM__HULL_MAX, 0.0, flat);
    if (built == DEM__HULL_FLAT) return "the corners lie in one plane";
    if (built == DEM__HULL_LARGE) return "its hull has more than 65536 corners";
    int32_t *is_used = h->given.begins;
    memset(is_used, 0, (size_t)n * sizeof *is_used);
    for (int32_t f = 0; f < h->given.facets; f++) {
        for (int k = 0; k < 3 && h->given.facet[f].alive; k++) is_used[h->given.facet[f].corner[k]] = 1;
    }
    for (ptrdiff_t k = 0; k < n; k++) h->corners += is_used[k];
    const double *one = x + 3 * h->given.facet[0].corner[0];
    const dem_vec middle = dem__point(one); /* any corner will do */
    dem__integrate_hull(&h->given, x, middle, &bulk);
    const char *reason = dem__set_moments(s, &bulk, middle, &c);
    if (reason) return reason;
    *status = DEM_OUT_OF_MEMORY;
    if (!dem__begin_hull_work(h, h->corners)) return "out of memory";
    *status = DEM_BAD_ARGUMENT;
    ptrdiff_t m = 0;
    for (ptrdiff_t k = 0; k < n; k++) {
        const dem_vec d = dem__sub(dem__sub(dem__point(x + 3 * k), middle), c);
        if (!is_used[k]) continue;
        for (int a = 0; a < 3; a++) h->y[3 * m + a] = dem__dot(d, s->axis[a]);
        h->from[m++] = (int32_t)k;
    }
    return NULL;
}

/* Marks the corners of the hull at which three or more faces meet. Returns how many. */
static inline ptrdiff_t dem__mark_corners(dem__hull_work *h) {
    ptrdiff_t marked = 0;
    for (int32_t k = 0; k < (int32_t)h->corners; k++) {
        int32_t seen[3];
        int n = 0;
        for (int32_t f = 0; f < h->far.facets && n < 3; f++) {
            const int32_t *c = h->far.facet[f].corner, plane = h->number[f];
            if (!h->far.facet[f].alive || plane < 0 || (c[0] != k && c[1] != k && c[2] != k)) continue;
            if ((n > 0 && seen[0] == plane) || (n > 1 && seen[1] == plane)) continue;
            seen[n++] = plane;
        }
        h->far.begins[k] = n == 3;
        marked += n == 3;
    }
    return marked;
}

/* Makes the exact shape of the marked corners. Returns whether that works. */
static inline int dem__make_exactly(const dem__hull_work *h, const double *x, double rounding, dem_convex *s) {
    dem_convex t;
    dem_vec middle = dem_vec3(0.0, 0.0, 0.0);
    int is_large;
    memset(&t, 0, sizeof t);
    for (ptrdiff_t k = 0; k < h->corners; k++) {
        if (!h->far.begins[k]) continue;
        memcpy(t.corner[t.corners++], x + 3 * h->from[k], sizeof t.corner[0]);
    }
    for (int k = 0; k < t.corners; k++) middle = dem__plus(middle, 1.0 / (double)t.corners, dem__point(t.corner[k]));
    for (int k = 0; k < 3 * t.corners; k++) t.corner[k / 3][k % 3] -= dem_axis(middle, k % 3);
    if (dem__shape_from(&t, middle, rounding, &is_large) != NULL) return 0;
    *s = t;
    return 1;
}

/* Finds the planes of the hull, and erodes it. Returns NULL, or what is wrong. */
static inline const char *dem__erode_hull(dem__hull_work *h, dem_convex *s, double rounding, double flat,
                                          dem_status *status) {
    s->radius = h->core.inwards = rounding * dem__least_width_of(&h->core, h->y, h->corners);
    *status = DEM_OUT_OF_MEMORY;
    if (!dem__begin_hull(&h->dual, &h->allocator, h->core.planes)) return "out of memory";
    *status = DEM_BAD_ARGUMENT;
    if (!dem__erode_planes(&h->dual, flat, h->work, &h->core)) return DEM__NO_CORE;
    *status = DEM_OUT_OF_MEMORY;
    if (!dem__begin_hull(&h->few, &h->allocator, h->core.points)) return "out of memory";
    *status = DEM_BAD_ARGUMENT;
    return NULL;
}

/* Makes the shape from the hull's corners. is_strict: every point must be a corner. Returns NULL, or what is wrong. */
static inline const char *dem__shape_of_hull(dem__hull_work *h, dem_convex *s, ptrdiff_t n, const double *x,
                                             double rounding, double tolerance, int is_strict, dem_status *status) {
    const char *reason = dem__measure_hull(h, s, n, x, status);
    if (reason) return reason;
    if (is_strict && h->corners < n)
        return "a point is no corner: it lies inside, in a face, on an edge or on another point";
    const double flat = DEM__FLAT * dem__half_size(h->y, (int)h->corners),
                 limit = tolerance * riddle_cbrt(6.0 / RIDDLE_PI * s->volume);
    const int32_t most = h->corners > DEM__ERODED_MAX ? DEM__ERODED_MAX : DEM__HULL_MAX;
    if (dem__build_hull(&h->far, h->y, most, 0.0, flat) != DEM__HULL_OK) return "the corners lie in one plane";
    dem__find_planes(&h->far, h->y, flat, &h->core, h->number);
    if (h->core.planes < 4) return "the corners lie in one plane";
    const double left = dem__left_out(&h->far);
    if (h->corners <= DEM__ERODED_MAX) {
        const ptrdiff_t marked = dem__mark_corners(h);
        if (is_strict && marked < n) return "a point is no corner: it lies in a face, on an edge or on another point";
        if (marked <= DEM_CORNERS_MAX && tolerance == 0.0 && dem__make_exactly(h, x, rounding, s)) return NULL;
    }
    if ((reason = dem__erode_hull(h, s, rounding, flat, status)) != NULL) return reason;
    s->given = (int)h->corners;
    int found = 0;
    dem_convex trial = *s;
    for (int k = 0; k <= DEM_CORNERS_MAX - 4 && !found; k++) {
        trial = *s;
        found = dem__reduce(&h->few, &h->core, tolerance > 0.0 ? 4 + k : DEM_CORNERS_MAX - k, flat, &trial) &&
                (tolerance == 0.0 || trial.deviation + left <= limit);
    }
    if (!found) return tolerance > 0.0 ? "no core of DEM_CORNERS_MAX corners is so near to it" : DEM__NO_CORE;
    *s = trial;
    s->deviation += left;
    dem__finish_shape(s);
    return NULL;
}

/* Makes a shape from the hull of n points, which have been counted. */
static inline dem_status dem__make_from_hull(dem_convex *shape, ptrdiff_t n, const double *x, double rounding,
                                             double tolerance, const dem_allocator *a, int is_strict,
                                             const char **reason) {
    dem__hull_work work;
    dem_status status = DEM_OK;
    memset(&work, 0, sizeof work);
    memset(shape, 0, sizeof *shape);
    work.allocator.fn = dem__default_allocator;
    if (a) work.allocator = *a;
    *reason = dem__shape_of_hull(&work, shape, n, x, rounding, tolerance, is_strict, &status);
    dem__end_hull_work(&work);
    return *reason ? status : DEM_OK;
}

/* Returns what is wrong with points, or NULL. */
static inline const char *dem__wrong_points(const dem_convex *shape, ptrdiff_t n, const double *x, double rounding) {
    if (!shape || !x) return "there is no place for the shape, or there are no corners";
    if (n < 4) return "there are fewer than 4 corners";
    if (n > INT32_MAX / 8) return "there are too many corners";
    if (!(rounding >= 0.001 && rounding <= 0.4)) return "the rounding is not 0.001 .. 0.4";
    for (ptrdiff_t k = 0; k < 3 * n; k++)
        if (!dem__moderate(x[k])) return "a corner is not finite";
    return NULL;
}

DEM_API dem_status dem_make_convex(dem_convex *shape, int n, const double *corners, double rounding,
                                   const char **reason) {
    const char *wrong = dem__wrong_points(shape, n, corners, rounding);
    dem_vec middle = dem_vec3(0.0, 0.0, 0.0);
    dem_status status = wrong ? DEM_BAD_ARGUMENT : DEM_OK;
    int is_large = n > DEM_CORNERS_MAX;
    if (!wrong && !is_large) {
        memset(shape, 0, sizeof *shape);
        shape->corners = n;
        for (int k = 0; k < n; k++) middle = dem__plus(middle, 1.0 / (double)n, dem__point(corners + 3 * k));
        for (int k = 0; k < 3 * n; k++) shape->corner[k / 3][k % 3] = corners[k] - dem_axis(middle, k % 3);
        wrong = dem__shape_from(shape, middle, rounding, &is_large);
        status = wrong ? DEM_BAD_ARGUMENT : DEM_OK;
    }
    if (is_large && (!wrong || n <= DEM_CORNERS_MAX))
        status = dem__make_from_hull(shape, n, corners, rounding, 0.0, NULL, 1, &wrong);
    if (reason) *reason = wrong;
    return status;
}

DEM_API dem_status dem_make_hull(dem_convex *shape, ptrdiff_t n, const double *points, double rounding,
                                 double tolerance, const dem_allocator *allocator, const char **reason) {
    const char *wrong = dem__wrong_points(shape, n, points, rounding);
    dem_status status = DEM_BAD_ARGUMENT;
    if (!wrong && !(tolerance >= 0.0 && tolerance <= 0.2)) wrong = "the tolerance is not 0 .. 0.2";
    if (!wrong) status = dem__make_from_hull(shape, n, points, rounding, tolerance, allocator, 0, &wrong);
    if (reason) *reason = wrong;
    return status;
}

DEM_API dem_status dem_make_brick(dem_convex *shape, dem_vec lengths, double rounding, const char **reason) {
    double corner[8][3];
    if (!dem__positive(lengths.x) || !dem__positive(lengths.y) || !dem__positive(lengths.z)) {
        if (reason) *reason = "a length is not a number above 0";
        return DEM_BAD_ARGUMENT;
    }
    for (int k = 0; k < 24; k++) corner[k / 3][k % 3] = (k / 3 >> k % 3 & 1 ? 0.5 : -0.5) * dem_axis(lengths, k % 3);
    return dem_make_convex(shape, 8, corner[0], rounding, reason);
}

#define DEM__CONVEX_MESH_MAX 4000 /* triangles of a mesh that is checked edge by edge */

/* Returns whether each edge of a mesh belongs to exactly one other triangle, in the opposite direction. */
static inline int dem__is_closed(const dem_mesh *mesh) {
    for (ptrdiff_t p = 0; p < 3 * mesh->triangles; p++) {
        const int32_t from = mesh->triangle[p], to = mesh->triangle[p % 3 < 2 ? p + 1 : p - 2];
        int same = 0, opposite = 0;
        for (ptrdiff_t q = 0; q < 3 * mesh->triangles; q++) {
            const int32_t a = mesh->triangle[q], b = mesh->triangle[q % 3 < 2 ? q + 1 : q - 2];
            same += a == from && b == to;
            opposite += a == to && b == from;
        }
        if (same != 1 || opposite != 1) return 0;
    }
    return 1;
}

/* Returns whether every corner of a mesh is behind every triangle, or in its plane. */
static inline int dem__is_convex(const dem_mesh *mesh) {
    const double flat = DEM__FLAT * dem__half_size(mesh->vertex, (int)mesh->vertices);
    for (ptrdiff_t t = 0; t < mesh->triangles; t++) {
        const dem_vec a = dem__point(mesh->vertex + 3 * mesh->triangle[3 * t]),
                      b = dem__point(mesh->vertex + 3 * mesh->triangle[3 * t + 1]),
                      c = dem__point(mesh->vertex + 3 * mesh->triangle[3 * t + 2]);
        const dem_vec n = dem__cross(dem__sub(b, a), dem__sub(c, a));
        const double area = dem__length(n);
        for (ptrdiff_t k = 0; k < mesh->vertices; k++) {
            if (dem__dot(n, dem__sub(dem__point(mesh->vertex + 3 * k), a)) > flat * area) return 0;
        }
    }
    return 1;
}

DEM_API dem_status dem_make_convex_mesh(dem_convex *shape, const dem_mesh *mesh, double rounding, const char **reason) {
    const char *wrong = NULL;
    if (!mesh || !mesh->vertex || !mesh->triangle) wrong = "there is no mesh";
    else if (mesh->vertices < 4) wrong = "there are fewer than 4 corners";
    else if (mesh->triangles < 4 || mesh->triangles > DEM__CONVEX_MESH_MAX)
        wrong = "the number of triangles is not 4 .. 4000: take the hull of the corners";
    for (ptrdiff_t k = 0; !wrong && k < 3 * mesh->triangles; k++) {
        if (mesh->triangle[k] < 0 || mesh->triangle[k] >= mesh->vertices)
            wrong = "a triangle has a corner that is not there";
    }
    for (ptrdiff_t k = 0; !wrong && k < 3 * mesh->vertices; k++) {
        if (!dem__moderate(mesh->vertex[k])) wrong = "a corner is not finite";
    }
    if (!wrong && !dem__is_closed(mesh))
        wrong = "the surface is not closed: an edge has not two triangles that run along it both ways";
    if (!wrong && !dem__is_convex(mesh)) wrong = "the surface is not convex, or its triangles face inwards";
    if (!wrong) return dem_make_hull(shape, mesh->vertices, mesh->vertex, rounding, 0.0, NULL, reason);
    if (reason) *reason = wrong;
    return DEM_BAD_ARGUMENT;
}
