/* Polyhedra given by their planes: areas of faces and the volume. Pure functions. */
#pragma once
#include "polyhedron.h"
#include "vectors.h"

enum { DEM__PLANES_MAX = DEM_FACES_MAX + 6 }; /* of a polyhedron cut by a box */

/* Returns a unit vector across u. */
static inline dem_vec dem__one_across(dem_vec u) {
    const dem_vec a = dem__cross(u, fabs(u.x) < 0.6 ? dem_vec3(1.0, 0.0, 0.0) : dem_vec3(0.0, 1.0, 0.0));
    return dem__scale(1.0 / dem__length(a), a);
}

/* Copies the planes of a shape without its rounding: a radius in front of those of its core. */
static inline void dem__sharp_planes(const dem_convex *s, double (*plane)[4]) {
    memcpy(plane, s->plane, (size_t)s->faces * sizeof *plane);
    for (int k = 0; k < s->faces; k++) plane[k][3] += s->radius;
}

/* Cuts from a polygon what is in front of a plane. Returns its number of corners. */
static inline int dem__cut_polygon(dem_vec *corner, int n, const double *plane) {
    dem_vec kept[DEM__PLANES_MAX + 4];
    int m = 0;
    for (int k = 0; k < n; k++) {
        const dem_vec a = corner[k], b = corner[(k + 1) % n];
        const double from = dem__dot(dem__point(plane), a) - plane[3], to = dem__dot(dem__point(plane), b) - plane[3];
        if (m > DEM__PLANES_MAX + 2) return 0; /* only by rounding */
        if (from <= 0.0) kept[m++] = a;
        if ((from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0))
            kept[m++] = dem__plus(a, from / (from - to), dem__sub(b, a));
    }
    memcpy(corner, kept, (size_t)m * sizeof *kept);
    return m;
}

static inline int dem__same_plane(const double *p, const double *q, double reach) {
    return dem__dot(dem__point(p), dem__point(q)) > 1.0 - 1e-12 && fabs(p[3] - q[3]) <= 1e-12 * reach;
}

/* Returns the area in which one of n planes bounds the space behind all of them. reach: no corner is 50 times as far
   from the origin. Of equal planes the first one counts. */
static inline double dem__face_area(const double (*plane)[4], int n, int face, double reach) {
    dem_vec corner[DEM__PLANES_MAX + 4];
    const dem_vec normal = dem__point(plane[face]), middle = dem__scale(plane[face][3], normal),
                  u = dem__scale(100.0 * reach, dem__one_across(normal)), v = dem__cross(normal, u);
    int m = 4;
    double area = 0.0;
    corner[0] = dem__add(middle, u), corner[1] = dem__add(middle, v);
    corner[2] = dem__sub(middle, u), corner[3] = dem__sub(middle, v);
    for (int k = 0; k < n && m > 0; k++) {
        if (k == face) continue;
        if (!dem__same_plane(plane[k], plane[face], reach)) m = dem__cut_polygon(corner, m, plane[k]);
        else if (k < face) return 0.0;
    }
    for (int k = 2; k < m; k++)
        area += 0.5 * dem__dot(normal, dem__cross(dem__sub(corner[k - 1], corner[0]), dem__sub(corner[k], corner[0])));
    return area > 0.0 ? area : 0.0;
}

/* Returns the volume behind n planes. */
static inline double dem__volume_behind(const double (*plane)[4], int n, double reach) {
    double volume = 0.0;
    for (int k = 0; k < n; k++) volume += plane[k][3] * dem__face_area(plane, n, k, reach) / 3.0;
    return volume > 0.0 ? volume : 0.0;
}
