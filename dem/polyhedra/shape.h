/* Convex polyhedra: faces from corners, mass properties, erosion. Promises: an accepted shape is closed and convex, and
   its tables agree with each other. */
#pragma once
#include "../base/definition.h"
#include "springs.h"

/* Corners closer than this to a plane, over the size of the whole, lie in it. The single precision of files is
   enough. */
#define DEM__FLAT 1e-6
#define DEM__NO_CORE "its core is no polyhedron: a smaller rounding leaves one"

/* The hull of a set of points: the planes with all other points behind them, and the points in each plane. */
typedef struct dem__hull {
    int faces;
    uint32_t holds[DEM_FACES_MAX];
    double plane[DEM_FACES_MAX][4], area[DEM_FACES_MAX];
} dem__hull;

/* Returns half the size of a set of points: half of the longest side of the box around it. */
static inline double dem__half_size(const double *x, int n) {
    double size = 0.0;
    for (int a = 0; a < 3; a++) {
        double low = x[a], high = x[a];
        for (int k = 1; k < n; k++)
            low = x[3 * k + a] < low ? x[3 * k + a] : low, high = x[3 * k + a] > high ? x[3 * k + a] : high;
        size = 0.5 * (high - low) > size ? 0.5 * (high - low) : size;
    }
    return size;
}

/* Adds a plane unless one has the same points; of the two, the one from the larger triangle stays. Returns 0 if there
   are too many. */
static inline int dem__add_face(dem__hull *hull, uint32_t holds, dem_vec n, double offset, double area) {
    int f = 0;
    while (f < hull->faces && hull->holds[f] != holds) f++;
    if (f < hull->faces && hull->area[f] >= area) return 1;
    if (f == DEM_FACES_MAX) return 0;
    if (f == hull->faces) hull->faces++;
    hull->holds[f] = holds, hull->area[f] = area;
    hull->plane[f][0] = n.x, hull->plane[f][1] = n.y, hull->plane[f][2] = n.z, hull->plane[f][3] = offset;
    return 1;
}

/* Adds the face in which three points lie, if no point is in front of it. Returns 0 if there are too many faces. */
static inline int dem__try_face(dem__hull *hull, const double *x, int n, int a, int b, int c, double flat) {
    const dem_vec p = dem__point(x + 3 * a), u = dem__sub(dem__point(x + 3 * b), p),
                  v = dem__sub(dem__point(x + 3 * c), p), cross = dem__cross(u, v);
    const double area = dem__length(cross), longest = dem__dot(u, u) > dem__dot(v, v) ? dem__dot(u, u) : dem__dot(v, v);
    double lowest = 0.0, highest = 0.0;
    uint32_t holds = 0;
    if (!(area > 1e-5 * longest)) return 1;
    const dem_vec normal = dem__scale(1.0 / area, cross);
    for (int k = 0; k < n; k++) {
        const double height = dem__dot(normal, dem__sub(dem__point(x + 3 * k), p));
        lowest = height < lowest ? height : lowest, highest = height > highest ? height : highest;
        if (fabs(height) <= flat) holds |= (uint32_t)1 << k;
    }
    if (highest <= flat && lowest < -flat) return dem__add_face(hull, holds, normal, dem__dot(normal, p), area);
    if (lowest >= -flat && highest > flat)
        return dem__add_face(hull, holds, dem__scale(-1.0, normal), -dem__dot(normal, p), area);
    return 1;
}

/* Finds the faces of the hull of points. Returns 0 if there are too many. */
static inline int dem__find_hull(dem__hull *hull, const double *x, int n, double flat) {
    hull->faces = 0;
    for (int a = 0; a < n; a++) {
        for (int b = a + 1; b < n; b++) {
            for (int c = b + 1; c < n; c++) {
                if (!dem__try_face(hull, x, n, a, b, c, flat)) return 0;
            }
        }
    }
    return 1;
}

/* Appends the corners of a face, counterclockwise from outside, to a list. Returns the new length, or 0 if they do not
   form a polygon. */
static inline int dem__go_round(const dem__hull *hull, int f, const double *x, int n, uint8_t *corner, int count) {
    const dem_vec normal = dem__point(hull->plane[f]);
    const int begin = count;
    int first = 0, at, total = 0;
    while (!(hull->holds[f] >> first & 1)) first++;
    for (int k = 0; k < n; k++) total += (int)(hull->holds[f] >> k & 1);
    at = first;
    do {
        int next = -1;
        if (count == 2 * DEM_EDGES_MAX || count - begin == total) return 0;
        corner[count++] = (uint8_t)at;
        for (int k = 0; k < n; k++) {
            if (k == at || !(hull->holds[f] >> k & 1)) continue;
            const dem_vec u = dem__sub(dem__point(x + 3 * k), dem__point(x + 3 * at));
            if (next < 0 ||
                dem__dot(normal, dem__cross(dem__sub(dem__point(x + 3 * next), dem__point(x + 3 * at)), u)) < 0.0)
                next = k;
        }
        at = next;
    } while (at != first);
    return count - begin == total && total > 2 ? count : 0;
}

/* Finds the edges from the corners of faces. Returns 0 if an edge does not have two faces or is too short, or the
   surface is not that of a ball. */
static inline int dem__find_edges(dem_convex *s, double shortest) {
    s->edges = 0;
    for (int f = 0; f < s->faces; f++) {
        for (int k = s->face_start[f], end = s->face_start[f + 1]; k < end; k++) {
            const int from = s->face_corner[k], to = s->face_corner[k + 1 < end ? k + 1 : s->face_start[f]];
            int e = 0, backward = 0;
            for (; e < s->edges; e++) {
                if (s->edge[e][0] == from && s->edge[e][1] == to) return 0;
                if (s->edge[e][0] == to && s->edge[e][1] == from) break;
            }
            backward = e < s->edges;
            if (!backward && s->edges++ == DEM_EDGES_MAX) return 0;
            if (!(dem__length(dem__sub(dem__point(s->corner[from]), dem__point(s->corner[to]))) > shortest)) return 0;
            if (!backward) s->edge[e][0] = (uint8_t)from, s->edge[e][1] = (uint8_t)to;
            s->edge_face[e][backward] = (uint8_t)f;
        }
    }
    int sides = 0;
    for (int f = 0; f < s->faces; f++) sides += s->face_start[f + 1] - s->face_start[f];
    return sides == 2 * s->edges && s->corners - s->edges + s->faces == 2;
}

/* Finds faces and edges of a shape whose corners are set. Returns NULL, or what is wrong. */
static inline const char *dem__find_surface(dem_convex *s, double flat) {
    dem__hull hull;
    int count = 0, used[DEM_CORNERS_MAX] = {0};
    if (!dem__find_hull(&hull, s->corner[0], s->corners, flat)) return "its faces are more than DEM_FACES_MAX";
    if (hull.faces < 4) return "the corners lie in one plane";
    s->faces = hull.faces;
    for (int f = 0; f < hull.faces; f++) {
        s->face_start[f] = (uint8_t)count;
        count = dem__go_round(&hull, f, s->corner[0], s->corners, s->face_corner, count);
        if (count == 0) return "a point is no corner: it lies in a face, on an edge or on another point";
        for (int a = 0; a < 4; a++) s->plane[f][a] = hull.plane[f][a];
        for (int k = s->face_start[f]; k < count; k++) used[s->face_corner[k]]++;
    }
    s->face_start[hull.faces] = (uint8_t)count;
    for (int k = 0; k < s->corners; k++) {
        if (used[k] == 0) return "a point is no corner: it lies inside";
        if (used[k] < 3) return "a point is no corner: it lies in a face, on an edge or on another point";
    }
    return dem__find_edges(s, flat) ? NULL : "a point is no corner: it lies in a face, on an edge or on another point";
}

/* Volume, first and second moments of a polyhedron, by signed tetrahedra from the origin to triangles of its faces. */
typedef struct dem__moments {
    double volume;
    dem_vec first;
    double second[3][3];
} dem__moments;
static inline void dem__add_triangle(dem__moments *bulk, const double *a, const double *b, const double *c) {
    const double six = dem__dot(dem__point(a), dem__cross(dem__point(b), dem__point(c)));
    const double sum[3] = {a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]};
    bulk->volume += six / 6.0;
    bulk->first = dem__plus(bulk->first, six / 24.0, dem__point(sum));
    for (int p = 0; p < 3; p++) {
        for (int q = 0; q < 3; q++)
            bulk->second[p][q] += six / 120.0 * (sum[p] * sum[q] + a[p] * a[q] + b[p] * b[q] + c[p] * c[q]);
    }
}
static inline void dem__integrate(const dem_convex *s, dem__moments *bulk) {
    memset(bulk, 0, sizeof *bulk);
    for (int f = 0; f < s->faces; f++) {
        const double *a = s->corner[s->face_corner[s->face_start[f]]];
        for (int k = s->face_start[f] + 2; k < s->face_start[f + 1]; k++)
            dem__add_triangle(bulk, a, s->corner[s->face_corner[k - 1]], s->corner[s->face_corner[k]]);
    }
}

/* Diagonalises a symmetric matrix (Jacobi). axis[k][a]: component a of principal axis k. A diagonal matrix is left as
   it is. */
static inline void dem__principal(double (*m)[3], double (*axis)[3]) {
    const double size = m[0][0] + m[1][1] + m[2][2];
    for (int p = 0; p < 3; p++) {
        for (int q = 0; q < 3; q++) axis[p][q] = p == q ? 1.0 : 0.0;
    }
    for (int sweep = 0; sweep < 30; sweep++) {
        for (int p = 0; p < 2; p++) {
            for (int q = p + 1; q < 3; q++) {
                if (fabs(m[p][q]) <= 1e-13 * size) continue;
                const double theta = 0.5 * (m[q][q] - m[p][p]) / m[p][q], root = sqrt(theta * theta + 1.0);
                const double t = theta < 0.0 ? -1.0 / (root - theta) : 1.0 / (root + theta),
                             c = 1.0 / sqrt(t * t + 1.0), s = t * c;
                for (int a = 0; a < 3; a++) {
                    const double old = m[a][p];
                    m[a][p] = c * old - s * m[a][q], m[a][q] = s * old + c * m[a][q];
                }
                for (int a = 0; a < 3; a++) {
                    double old = m[p][a];
                    m[p][a] = c * old - s * m[q][a], m[q][a] = s * old + c * m[q][a];
                    old = axis[p][a];
                    axis[p][a] = c * old - s * axis[q][a], axis[q][a] = s * old + c * axis[q][a];
                }
            }
        }
    }
}

/* Sets volume, centroid, moments and axes. centre: the centroid, from the middle. Returns NULL, or what is wrong. */
static inline const char *dem__set_moments(dem_convex *s, const dem__moments *bulk, dem_vec middle, dem_vec *centre) {
    double second[3][3], axis[3][3];
    if (!(bulk->volume > 0.0 && bulk->volume < HUGE_VAL)) return "the corners lie in one plane";
    const dem_vec c = *centre = dem__scale(1.0 / bulk->volume, bulk->first);
    for (int p = 0; p < 3; p++) {
        for (int q = 0; q < 3; q++) second[p][q] = bulk->second[p][q] - bulk->volume * dem_axis(c, p) * dem_axis(c, q);
    }
    dem__principal(second, axis);
    s->volume = bulk->volume;
    s->centroid = dem__add(middle, c);
    for (int a = 0; a < 3; a++) {
        s->axis[a] = dem__point(axis[a]);
        s->moment[a] = second[(a + 1) % 3][(a + 1) % 3] + second[(a + 2) % 3][(a + 2) % 3];
        if (!(s->moment[a] > 0.0 && s->moment[a] < HUGE_VAL))
            return "it is too small or too large for its inertia to be a number";
    }
    return NULL;
}

/* Does so from the faces. Moves the corners to the centroid and turns them to the principal axes. Returns NULL, or what
   is wrong. */
static inline const char *dem__set_bulk(dem_convex *s, dem_vec middle) {
    dem__moments bulk;
    dem_vec c;
    dem__integrate(s, &bulk);
    const char *reason = dem__set_moments(s, &bulk, middle, &c);
    if (reason) return reason;
    for (int k = 0; k < s->corners; k++) {
        const dem_vec d = dem__sub(dem__point(s->corner[k]), c);
        for (int a = 0; a < 3; a++) s->corner[k][a] = dem__dot(d, s->axis[a]);
    }
    return NULL;
}

/* Finds the point where three planes meet after they have moved inwards. Returns the absolute value of their
   determinant; 0 if that is below `least`. */
static inline double dem__meet(const double *p, const double *q, const double *r, double inwards, double least,
                               dem_vec *at) {
    const dem_vec a = dem__point(p), b = dem__point(q), c = dem__point(r), bc = dem__cross(b, c);
    const double det = dem__dot(a, bc);
    if (fabs(det) < least) return 0.0;
    const dem_vec sum =
        dem__add(dem__scale(p[3] - inwards, bc),
                 dem__add(dem__scale(q[3] - inwards, dem__cross(c, a)), dem__scale(r[3] - inwards, dem__cross(a, b))));
    *at = dem__scale(1.0 / det, sum);
    return fabs(det);
}

/* Adds a corner of the core unless it is there; of two equal corners the better determined one stays. Returns 0 if
   there are too many. */
static inline int dem__add_corner(dem_convex *core, double *sure, dem_vec x, double det, double same) {
    int k = 0;
    while (k < core->corners && !(dem__length(dem__sub(x, dem__point(core->corner[k]))) <= same)) k++;
    if (k == DEM_CORNERS_MAX) return 0;
    if (k < core->corners && sure[k] >= det) return 1;
    if (k == core->corners) core->corners++;
    core->corner[k][0] = x.x, core->corner[k][1] = x.y, core->corner[k][2] = x.z;
    sure[k] = det;
    return 1;
}

/* Finds the corners of a shape whose faces have moved inwards by a radius: where three of the planes meet, behind all
   others. Returns 0 if there are too many. */
static inline int dem__erode(const dem_convex *s, dem_convex *core, double radius, double flat) {
    double sure[DEM_CORNERS_MAX];
    core->corners = 0;
    for (int a = 0; a < s->faces; a++) {
        for (int b = a + 1; b < s->faces; b++) {
            for (int c = b + 1; c < s->faces; c++) {
                dem_vec x;
                int f = 0;
                const double det = dem__meet(s->plane[a], s->plane[b], s->plane[c], radius, 1e-6, &x);
                if (det == 0.0) continue;
                while (f < s->faces && dem__dot(dem__point(s->plane[f]), x) <= s->plane[f][3] - radius + 0.1 * flat)
                    f++;
                if (f == s->faces && !dem__add_corner(core, sure, x, det, flat)) return 0;
            }
        }
    }
    return 1;
}

/* Returns the smallest distance between a face and the corner opposite to it. */
static inline double dem__least_width(const dem_convex *s) {
    double least = HUGE_VAL;
    for (int f = 0; f < s->faces; f++) {
        double deepest = 0.0;
        for (int k = 0; k < s->corners; k++) {
            const double depth = s->plane[f][3] - dem__dot(dem__point(s->plane[f]), dem__point(s->corner[k]));
            deepest = depth > deepest ? depth : deepest;
        }
        least = deepest < least ? deepest : least;
    }
    return least;
}

/* Finds whether the core is a box along the axes, with its middle at the centroid. Sets its corners to the half lengths
   to the last bit, because distances are computed from these. */
static inline void dem__find_box(dem_convex *s) {
    const double *h = s->corner[0];
    s->half = dem_vec3(fabs(h[0]), fabs(h[1]), fabs(h[2]));
    s->is_box = s->corners == 8 && s->faces == 6;
    for (int k = 0; k < s->corners; k++) {
        for (int a = 0; a < 3; a++) s->is_box &= fabs(fabs(s->corner[k][a]) - dem_axis(s->half, a)) <= 1e-9 * s->reach;
    }
    for (int k = 0; k < s->corners && s->is_box; k++) {
        for (int a = 0; a < 3; a++)
            s->corner[k][a] = s->corner[k][a] < 0.0 ? -dem_axis(s->half, a) : dem_axis(s->half, a);
    }
}

/* Turns corners and planes of a shape. Its axes become x, y and z, the columns of the rotation. */
static inline void dem__turn_shape(dem_convex *s, dem_vec x, dem_vec y, dem_vec z) {
    if (x.x == 1.0 && y.y == 1.0 && z.z == 1.0) return;
    for (int k = 0; k < s->corners + s->faces; k++) {
        double *v = k < s->corners ? s->corner[k] : s->plane[k - s->corners];
        const dem_vec at = dem__plus(dem__plus(dem__scale(v[0], x), v[1], y), v[2], z);
        v[0] = at.x, v[1] = at.y, v[2] = at.z;
    }
}
/* Turns corners and planes from the principal axes to the frame in which the shape was given. */
static inline void dem__turn_to_given(dem_convex *s) {
    dem__turn_shape(s, s->axis[0], s->axis[1], s->axis[2]);
    s->along_axes = 0;
}
/* Turns corners and planes to the principal axes. The corners of a box then equal the half lengths to the last bit. */
static inline void dem__turn_to_axes(dem_convex *s) {
    const dem_vec *a = s->axis;
    if (!s->along_axes)
        dem__turn_shape(s, dem_vec3(a[0].x, a[1].x, a[2].x), dem_vec3(a[0].y, a[1].y, a[2].y),
                        dem_vec3(a[0].z, a[1].z, a[2].z));
    for (int k = 0; k < 3 * s->corners && s->is_box; k++) {
        double *v = &s->corner[k / 3][k % 3], half = dem_axis(s->half, k % 3);
        *v = *v < 0.0 ? -half : half;
    }
    s->along_axes = 1;
}
/* Returns whether the axes of a shape are a right-handed frame. */
static inline int dem__are_axes(const dem_vec *a) {
    const double size = dem__dot(a[0], dem__cross(a[1], a[2]));
    int right = fabs(size - 1.0) < 1e-6;
    for (int k = 0; k < 3; k++) right &= fabs(dem__dot(a[k], a[k]) - 1.0) < 1e-6;
    return right;
}

/* Completes a shape whose core has its corners, faces and edges, along the principal axes. */
static inline void dem__finish_shape(dem_convex *core) {
    core->reach = 0.0;
    for (int k = 0; k < core->corners; k++) {
        const double far = dem__length(dem__point(core->corner[k])) + core->radius;
        core->reach = far > core->reach ? far : core->reach;
    }
    dem__find_box(core);
    dem__find_springs(core);
    dem__turn_to_given(core);
}

/* Makes the shape from corners relative to their middle. Returns NULL, or what is wrong. is_large: set if its core has
   too many corners. */
static inline const char *dem__shape_from(dem_convex *s, dem_vec middle, double rounding, int *is_large) {
    dem_convex core;
    const double flat = DEM__FLAT * dem__half_size(s->corner[0], s->corners);
    const char *reason;
    if (!(flat > 0.0)) return "the corners lie in one point";
    if ((reason = dem__find_surface(s, flat)) != NULL) return reason;
    if ((reason = dem__set_bulk(s, middle)) != NULL) return reason;
    if ((reason = dem__find_surface(s, flat)) != NULL) return reason; /* planes in the new frame */
    core = *s;
    core.radius = rounding * dem__least_width(s);
    *is_large = !dem__erode(s, &core, core.radius, flat);
    if (*is_large) return "its core has more than DEM_CORNERS_MAX corners";
    if (dem__find_surface(&core, 0.1 * flat) != NULL) return DEM__NO_CORE;
    core.given = s->corners;
    dem__finish_shape(&core);
    *s = core;
    return NULL;
}
