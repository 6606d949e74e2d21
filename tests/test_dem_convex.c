/* Convex polyhedra of dem.h: their making, distances against a search through all features, points of contact. */
#include "dem.h"
#include "../examples/common/random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#include "near.h"

static uint64_t seed = 1;
static double uniform(double low, double high) { return low + (high - low) * random_plain(&seed); }

static dem__placed placed(dem_vec x, double w, double a, double b, double c) { /* by a quaternion of any length */
    const double f = 1.0 / sqrt(w * w + a * a + b * b + c * c);
    dem__placed p;
    w *= f, a *= f, b *= f, c *= f;
    p.x = x;
    p.axis[0] = dem_vec3(1 - 2 * (b * b + c * c), 2 * (a * b + c * w), 2 * (a * c - b * w));
    p.axis[1] = dem_vec3(2 * (a * b - c * w), 1 - 2 * (a * a + c * c), 2 * (b * c + a * w));
    p.axis[2] = dem_vec3(2 * (a * c + b * w), 2 * (b * c - a * w), 1 - 2 * (a * a + b * b));
    return p;
}
static dem__placed anyhow(double far) {
    double at[3], turn[4]; /* one after the other: compilers evaluate arguments in orders of their own */
    for (int a = 0; a < 3; a++) at[a] = uniform(-far, far);
    for (int a = 0; a < 4; a++) turn[a] = uniform(-1, 1);
    return placed(dem_vec3(at[0], at[1], at[2]), turn[0], turn[1], turn[2], turn[3]);
}

static void octahedron(dem_convex *s, double a) {
    const double x[18] = {a, 0, 0, -a, 0, 0, 0, a, 0, 0, -a, 0, 0, 0, a, 0, 0, -a};
    assert_int_equal(dem_make_convex(s, 6, x, 0.03, NULL), DEM_OK);
}
static void tetrahedron(dem_convex *s, double a, double rounding) {
    const double h = a / sqrt(8.0), x[12] = {h, h, h, h, -h, -h, -h, h, -h, -h, -h, h};
    assert_int_equal(dem_make_convex(s, 4, x, rounding, NULL), DEM_OK);
}
static void prism(dem_convex *s) { /* upright, over a triangle */
    const double x[18] = {0, 0, 0, 1, 0, 0, 0.2, 0.7, 0, 0, 0, 1.3, 1, 0, 1.3, 0.2, 0.7, 1.3};
    assert_int_equal(dem_make_convex(s, 6, x, 0.03, NULL), DEM_OK);
}
static void brick(dem_convex *s) { assert_int_equal(dem_make_brick(s, dem_vec3(1.0, 1.0, 2.08), 0.03, NULL), DEM_OK); }

/* Volume, moments and extents in closed form. */
static void test_mass(void **state) {
    (void)state;
    dem_convex s;
    brick(&s);
    near(s.volume, 2.08, 1e-14);
    near(s.moment[0] / s.volume, (1.0 + 2.08 * 2.08) / 12.0, 1e-14);
    near(s.moment[0] / s.volume, 0.443866666667, 1e-12);
    near(s.moment[1], s.moment[0], 1e-15);
    near(s.moment[2] / s.volume, 1.0 / 6.0, 1e-14);
    near(s.radius, 0.03, 1e-15);
    near(s.half.z, 1.01, 1e-14);
    assert_int_equal(s.is_box, 1);
    assert_int_equal(s.edges, 12);
    tetrahedron(&s, 2.0, 0.03);
    near(s.volume, 8.0 / (6.0 * sqrt(2.0)), 1e-14);
    for (int a = 0; a < 3; a++) near(s.moment[a] / s.volume, 4.0 / 20.0, 1e-14);
    octahedron(&s, 1.5);
    near(s.volume, 4.0 / 3.0 * 1.5 * 1.5 * 1.5, 1e-14);
    for (int a = 0; a < 3; a++) near(s.moment[a] / s.volume, 1.5 * 1.5 / 5.0, 1e-14);
    assert_int_equal(s.corners, 6);
    prism(&s);
    near(s.volume, 0.5 * 0.7 * 1.3, 1e-14);
    near(s.centroid.x, 0.4, 1e-14);
    near(s.centroid.y, 0.7 / 3.0, 1e-14);
    near(s.centroid.z, 0.65, 1e-14);
}

/* Turned and shifted before it is made, a brick has the same moments, and its axes lead back. */
static void test_turned(void **state) {
    (void)state;
    for (int n = 0; n < 2000; n++) {
        const dem__placed p = anyhow(5.0);
        const double half[3] = {0.4, 0.5, 0.9};
        double x[24];
        dem_convex s;
        for (int k = 0; k < 8; k++) {
            const dem_vec v =
                dem_vec3(k & 1 ? half[0] : -half[0], k & 2 ? half[1] : -half[1], k & 4 ? half[2] : -half[2]);
            const dem_vec at = dem__add(p.x, dem__from_core_frame(&p, v));
            x[3 * k] = at.x, x[3 * k + 1] = at.y, x[3 * k + 2] = at.z;
        }
        assert_int_equal(dem_make_convex(&s, 8, x, 0.05, NULL), DEM_OK);
        near(s.volume, 8 * 0.4 * 0.5 * 0.9, 1e-13);
        assert_true(dem__length(dem__sub(s.centroid, p.x)) < 1e-13);
        near(dem__dot(s.axis[2], dem__cross(s.axis[0], s.axis[1])), 1.0, 1e-13);
        assert_int_equal(s.is_box, 1);
        near(s.half.x * s.half.y * s.half.z, (0.4 - s.radius) * (0.5 - s.radius) * (0.9 - s.radius), 1e-12);
        double sum = s.moment[0] + s.moment[1] + s.moment[2];
        near(sum / s.volume, 2.0 / 3.0 * (0.16 + 0.25 + 0.81), 1e-12);
    }
}

/* The core's faces lie a radius below the outer ones. */
static void test_erosion(void **state) {
    (void)state;
    dem_convex s;
    tetrahedron(&s, 2.0, 0.1);
    /* radius of the inscribed */
    for (int f = 0; f < 4; f++) near(s.plane[f][3] + s.radius, 2.0 / (2.0 * sqrt(6.0)), 1e-13);
    /* Where four faces meet: the core has a ridge. */
    const double apex[15] = {1, 1, 0, -1, 1, 0, -1, -1.2, 0, 1, -1, 0, 0.2, 0.1, 2};
    assert_int_equal(dem_make_convex(&s, 5, apex, 0.1, NULL), DEM_OK);
    assert_true(s.faces == 5 && s.corners == 6 && s.edges == 9);
}

static void test_refused(void **state) {
    (void)state;
    dem_convex s;
    const char *reason = NULL;
    double cube[30];
    for (int k = 0; k < 24; k++) cube[k] = k / 3 >> k % 3 & 1 ? 1.0 : 0.0;
    assert_int_equal(dem_make_convex(&s, 8, cube, 0.03, &reason), DEM_OK);
    assert_null(reason);
    const double extra[5][3] = {{0.5, 0.5, 0.5}, {0.5, 0.5, 0.0}, {0.5, 0.0, 0.0}, {1.0, 1.0, 1.0}, {0.25, 0.75, 1e-9}};
    for (int e = 0; e < 5; e++) {
        for (int a = 0; a < 3; a++) cube[24 + a] = extra[e][a];
        assert_int_equal(dem_make_convex(&s, 9, cube, 0.03, &reason), DEM_BAD_ARGUMENT);
        assert_non_null(strstr(reason, "no corner"));
    }
    const double flat[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    assert_int_equal(dem_make_convex(&s, 4, flat, 0.03, &reason), DEM_BAD_ARGUMENT);
    assert_non_null(strstr(reason, "one plane"));
    const double same[12] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    assert_int_equal(dem_make_convex(&s, 4, same, 0.03, &reason), DEM_BAD_ARGUMENT);
    const double bad[] = {NAN, HUGE_VAL, -HUGE_VAL, 1e300};
    for (int k = 0; k < 4; k++) {
        cube[4] = bad[k];
        assert_int_equal(dem_make_convex(&s, 8, cube, 0.03, &reason), DEM_BAD_ARGUMENT);
        cube[4] = 0.0;
        assert_int_equal(dem_make_convex(&s, 8, cube, bad[k], &reason), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_make_brick(&s, dem_vec3(1.0, bad[k], 1.0), 0.03, &reason), DEM_BAD_ARGUMENT);
    }
    assert_int_equal(dem_make_brick(&s, dem_vec3(1.0, 0.0, 1.0), 0.03, &reason), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_brick(&s, dem_vec3(1e-300, 1e-300, 1e-300), 0.03, &reason), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_brick(&s, dem_vec3(1e-6, 1e-6, 1e-6), 0.03, &reason), DEM_OK);
    assert_int_equal(dem_make_convex(&s, 3, cube, 0.03, &reason), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_convex(&s, 8, cube, 0.0, &reason), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_convex(&s, 8, NULL, 0.03, NULL), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_convex(NULL, 8, cube, 0.03, NULL), DEM_BAD_ARGUMENT);
}

static void test_mesh(void **state) {
    (void)state;
    double x[24];
    int32_t t[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                     2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    dem_mesh mesh;
    dem_convex s;
    const char *reason = NULL;
    memset(&mesh, 0, sizeof mesh);
    for (int k = 0; k < 24; k++) x[k] = k / 3 >> k % 3 & 1 ? 1.0 : 0.0;
    mesh.vertices = 8, mesh.triangles = 12, mesh.vertex = x, mesh.triangle = t;
    assert_int_equal(dem_make_convex_mesh(&s, &mesh, 0.03, &reason), DEM_OK);
    assert_true(s.faces == 6 && s.is_box);
    mesh.triangles = 11;
    assert_int_equal(dem_make_convex_mesh(&s, &mesh, 0.03, &reason), DEM_BAD_ARGUMENT);
    assert_non_null(strstr(reason, "not closed"));
    mesh.triangles = 12;
    t[35] = 8;
    assert_int_equal(dem_make_convex_mesh(&s, &mesh, 0.03, &reason), DEM_BAD_ARGUMENT);
    t[35] = 5;
    for (int k = 0; k < 12; k++) {
        const int32_t swap = t[3 * k];
        t[3 * k] = t[3 * k + 1], t[3 * k + 1] = swap;
    }
    assert_int_equal(dem_make_convex_mesh(&s, &mesh, 0.03, &reason), DEM_BAD_ARGUMENT); /* inside out */
    assert_non_null(strstr(reason, "not convex"));
    for (int k = 0; k < 12; k++) {
        const int32_t swap = t[3 * k];
        t[3 * k] = t[3 * k + 1], t[3 * k + 1] = swap;
    }
    x[21] = x[22] = x[23] = 0.6; /* a corner pushed in */
    assert_int_equal(dem_make_convex_mesh(&s, &mesh, 0.03, &reason), DEM_BAD_ARGUMENT);
    assert_non_null(strstr(reason, "not convex"));
    assert_int_equal(dem_make_convex_mesh(&s, NULL, 0.03, NULL), DEM_BAD_ARGUMENT);
}

/* ---- hulls of many points ---- */

enum { POINTS = 400 };
/* Points on an ellipsoid, of which none is within the hull of the others. */
static int rock(double *x, int n, double size) {
    const double axis[3] = {size, uniform(0.6, 1.0) * size, uniform(0.4, 0.9) * size};
    for (int k = 0; k < n; k++) {
        dem_vec v = dem_vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
        while (dem__dot(v, v) > 1.0 || dem__dot(v, v) < 0.01)
            v = dem_vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
        v = dem__scale(1.0 / dem__length(v), v);
        for (int a = 0; a < 3; a++) x[3 * k + a] = axis[a] * (dem_axis(v, a) + 3.0);
    }
    return n;
}
static dem_vec at(const double *x, int k) { return dem_vec3(x[3 * k], x[3 * k + 1], x[3 * k + 2]); }

/* A hull by trying all triangles: its faces, volume and moments about the centroid, as sums over tetrahedra from its
   first point. */
typedef struct slow_hull {
    int faces;
    int32_t face[2 * POINTS][3];
    dem_vec normal[2 * POINTS], first;
    double offset[2 * POINTS], volume, second[3][3];
} slow_hull;
static void find_slowly(slow_hull *h, const double *x, int n) {
    const dem_vec o = at(x, 0);
    memset(h, 0, sizeof *h);
    for (int a = 0; a < n; a++) {
        for (int b = a + 1; b < n; b++) {
            for (int c = b + 1; c < n; c++) {
                const dem_vec u = dem__cross(dem__sub(at(x, b), at(x, a)), dem__sub(at(x, c), at(x, a)));
                int above = 0, below = 0;
                for (int k = 0; k < n && !(above && below); k++) {
                    const double height = dem__dot(u, dem__sub(at(x, k), at(x, a)));
                    above |= k != a && k != b && k != c && height > 0.0,
                        below |= k != a && k != b && k != c && height <= 0.0;
                }
                if (above && below) continue;
                const double sign = above ? -1.0 : 1.0;
                const int f = h->faces++;
                h->face[f][0] = a, h->face[f][1] = above ? c : b, h->face[f][2] = above ? b : c;
                h->normal[f] = dem__scale(sign / dem__length(u), u), h->offset[f] = dem__dot(h->normal[f], at(x, a));
                const dem_vec p[3] = {dem__sub(at(x, a), o), dem__sub(at(x, b), o), dem__sub(at(x, c), o)},
                              s = dem__add(p[0], dem__add(p[1], p[2]));
                const double six = sign * dem__dot(p[0], dem__cross(p[1], p[2]));
                h->volume += six / 6.0, h->first = dem__plus(h->first, six / 24.0, s);
                for (int k = 0; k < 9; k++) {
                    double sum = dem_axis(s, k / 3) * dem_axis(s, k % 3);
                    for (int q = 0; q < 3; q++) sum += dem_axis(p[q], k / 3) * dem_axis(p[q], k % 3);
                    h->second[k / 3][k % 3] += six / 120.0 * sum;
                }
            }
        }
    }
    const dem_vec c = dem__scale(1.0 / h->volume, h->first);
    for (int k = 0; k < 9; k++) h->second[k / 3][k % 3] -= h->volume * dem_axis(c, k / 3) * dem_axis(c, k % 3);
    h->first = dem__add(o, c); /* the centroid */
}

/* Moments of a shape about its axes are those of the hull about the same axes, and products vanish. */
static void has_moments(const dem_convex *s, const slow_hull *h, double tolerance) {
    const double trace = h->second[0][0] + h->second[1][1] + h->second[2][2];
    assert_true(fabs(s->volume / h->volume - 1.0) < tolerance);
    assert_true(dem__length(dem__sub(s->centroid, h->first)) < 10.0 * tolerance * s->reach);
    for (int a = 0; a < 3; a++) {
        const dem_vec u = s->axis[a], v = s->axis[(a + 1) % 3];
        double own = 0.0, mixed = 0.0;
        for (int k = 0; k < 9; k++) {
            own += h->second[k / 3][k % 3] * dem_axis(u, k / 3) * dem_axis(u, k % 3);
            mixed += h->second[k / 3][k % 3] * dem_axis(u, k / 3) * dem_axis(v, k % 3);
        }
        assert_true(fabs(s->moment[a] / (trace - own) - 1.0) < tolerance);
        assert_true(fabs(mixed) < tolerance * trace);
    }
}

static double support(const dem_convex *s, dem_vec u) {
    double most = -HUGE_VAL;
    for (int k = 0; k < s->corners; k++) most = fmax(most, dem__dot(u, dem__point(s->corner[k])));
    return dem__dot(u, s->centroid) + most + s->radius;
}

/* The surface of a shape is as near to that of the hull as it says: nowhere farther out, and no face farther in. */
static void is_near_hull(const dem_convex *s, const slow_hull *h, const double *x, int n) {
    const double slack = 1e-6 * s->reach;
    for (int k = 0; k < 200; k++) {
        const dem_vec v = dem_vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)),
                      u = dem__scale(1.0 / dem__length(v), v);
        double most = -HUGE_VAL;
        for (int q = 0; q < n; q++) most = fmax(most, dem__dot(u, at(x, q)));
        assert_true(support(s, u) < most + s->deviation + slack);
    }
    for (int f = 0; f < h->faces; f++)
        assert_true(fabs(support(s, h->normal[f]) - h->offset[f]) < s->deviation + slack);
}

/* Rocks of 8 to 300 corners are accepted, with the moments of all corners. What is cut is told. */
static void test_hulls(void **state) {
    (void)state;
    const int number[] = {8, 11, 12, 13, 20, 32, 33, 64, 120, 300};
    for (int m = 0; m < 10; m++) {
        for (int trial = 0; trial < (m < 8 ? 5 : 1); trial++) {
            double x[3 * POINTS];
            static slow_hull h;
            dem_convex s, other;
            const char *reason = NULL;
            const int n = rock(x, number[m], trial % 2 ? 1.0 : 1e-3);
            find_slowly(&h, x, n);
            assert_int_equal(h.faces, 2 * n - 4);
            assert_int_equal(dem_make_convex(&s, n, x, 0.03, &reason), DEM_OK);
            assert_null(reason);
            assert_int_equal(s.given, n);
            has_moments(&s, &h, 1e-12);
            is_near_hull(&s, &h, x, n);
            assert_true(n > 11 || s.deviation == 0.0);
            const double size = cbrt(6.0 * s.volume / RIDDLE_PI);
            assert_true(s.deviation < (n <= 32 ? 0.02 : 0.06) * size);
            assert_int_equal(dem_make_hull(&other, n, x, 0.03, 0.0, NULL, &reason), DEM_OK);
            assert_true(other.corners == s.corners && fabs(other.volume / s.volume - 1.0) < 1e-13);
            assert_true(fabs(other.deviation - s.deviation) < 1e-6 * size);
        }
    }
}

/* A prism over a regular polygon, in closed form; its ends stay flat when corners are left out. */
static void test_round_prism(void **state) {
    (void)state;
    for (int sides = 4; sides <= 150; sides = sides < 20 ? sides + 1 : 3 * sides / 2) {
        double x[6 * 150];
        const dem__placed p = anyhow(5.0);
        const double angle = 2.0 * RIDDLE_PI / sides, height = 0.7, radius = 1.1;
        for (int k = 0; k < 2 * sides; k++) {
            const dem_vec v =
                dem__add(p.x, dem__from_core_frame(&p, dem_vec3(radius * cos(angle * (k / 2)),
                                                                radius * sin(angle * (k / 2)), k % 2 ? height : 0.0)));
            x[3 * k] = v.x, x[3 * k + 1] = v.y, x[3 * k + 2] = v.z;
        }
        dem_convex s;
        const char *reason = NULL;
        assert_int_equal(dem_make_convex(&s, 2 * sides, x, 0.03, &reason), DEM_OK);
        /* Mean of x^2. */
        const double area = 0.5 * sides * radius * radius * sin(angle),
                     square = radius * radius / 12.0 * (2.0 + cos(angle));
        close_to(s.volume, area * height, 1e-12);
        double least = HUGE_VAL, most = 0.0;
        for (int a = 0; a < 3; a++)
            least = fmin(least, s.moment[a] / s.volume), most = fmax(most, s.moment[a] / s.volume);
        const double along = 2.0 * square, across = square + height * height / 12.0;
        close_to(least, fmin(along, across), 1e-12), close_to(most, fmax(along, across), 1e-12);
        int flat = 0;
        for (int f = 0; f < s.faces; f++) {
            const double up = dem__dot(dem__point(s.plane[f]), p.axis[2]);
            if (fabs(up) < 1.0 - 1e-9) continue;
            flat++;
            close_to(s.plane[f][3] + s.radius, 0.5 * height, 1e-5);
        }
        assert_int_equal(flat, 2);
        assert_true(sides > 16 || s.deviation == 0.0);
    }
}

static void in_order(double *v) {
    for (int k = 0; k < 3; k++) {
        const int a = k % 2;
        if (v[a] > v[a + 1]) {
            const double swap = v[a];
            v[a] = v[a + 1], v[a + 1] = swap;
        }
    }
}

/* What must not matter: order, place, size, orientation, points within, points given twice. */
static void test_same_hull(void **state) {
    (void)state;
    for (int trial = 0; trial < 6; trial++) {
        double x[3 * POINTS], y[3 * POINTS];
        dem_convex s, other;
        const int n = rock(x, trial < 3 ? 30 : 90, 1.0), more = n + 41;
        const double factor = trial % 2 ? 1e-3 : 1.0;
        const dem__placed p = anyhow(2.0);
        assert_int_equal(dem_make_hull(&s, n, x, 0.05, 0.0, NULL, NULL), DEM_OK);
        for (int k = n; k < more; k++) { /* between two corners, or on one */
            const int i = (int)uniform(0, n), j = (int)uniform(0, n);
            const double part = k % 2 ? 0.0 : uniform(0.1, 0.9);
            for (int a = 0; a < 3; a++) x[3 * k + a] = (1.0 - part) * x[3 * i + a] + part * x[3 * j + a];
        }
        for (int k = 0; k < more; k++) {
            const dem_vec v = dem__scale(factor, dem__add(p.x, dem__from_core_frame(&p, at(x, k))));
            const int to = (7 * k + 3) % more;
            y[3 * to] = v.x, y[3 * to + 1] = v.y, y[3 * to + 2] = v.z;
        }
        assert_true(more % 7 != 0);
        assert_int_equal(dem_make_hull(&other, more, y, 0.05, 0.0, NULL, NULL), DEM_OK);
        close_to(other.volume, s.volume * factor * factor * factor, 1e-11);
        double own[3], turned[3];
        for (int a = 0; a < 3; a++) own[a] = s.moment[a] * pow(factor, 5.0), turned[a] = other.moment[a];
        in_order(own), in_order(turned);
        for (int a = 0; a < 3; a++) close_to(turned[a], own[a], 1e-11);
        close_to(other.radius, s.radius * factor, 1e-9);
        assert_true(fabs(other.deviation / factor - s.deviation) < 0.5 * s.deviation + 1e-6);
        assert_int_equal(dem_make_convex(&other, more, y, 0.05, NULL), DEM_BAD_ARGUMENT); /* some are no corner */
    }
}

/* As few corners as a tolerance allows; a lattice of points is a brick; what is no hull is refused. */
static void test_hull_options(void **state) {
    (void)state;
    double x[3 * POINTS];
    dem_convex s;
    const char *reason = NULL;
    int corners = DEM_CORNERS_MAX + 1;
    rock(x, 200, 1e-2);
    const double tolerance[] = {0.05, 0.08, 0.12, 0.2};
    for (int k = 0; k < 4; k++) {
        assert_int_equal(dem_make_hull(&s, 200, x, 0.05, tolerance[k], NULL, &reason), DEM_OK);
        assert_true(s.deviation <= tolerance[k] * cbrt(6.0 * s.volume / RIDDLE_PI) && s.corners <= corners);
        corners = s.corners;
    }
    assert_true(corners < 14);
    assert_int_equal(dem_make_hull(&s, 200, x, 0.05, 1e-4, NULL, &reason), DEM_BAD_ARGUMENT);
    assert_non_null(strstr(reason, "near"));
    const double bad[] = {-1e-3, 0.21, NAN};
    for (int k = 0; k < 3; k++)
        assert_int_equal(dem_make_hull(&s, 200, x, 0.05, bad[k], NULL, &reason), DEM_BAD_ARGUMENT);
    for (int k = 0; k < 125; k++)
        x[3 * k] = 1e-3 * (k % 5), x[3 * k + 1] = 2e-3 * (k / 5 % 5), x[3 * k + 2] = 3e-3 * (k / 25);
    assert_int_equal(dem_make_hull(&s, 125, x, 0.05, 0.0, NULL, &reason), DEM_OK);
    assert_true(s.is_box && s.corners == 8 && s.deviation == 0.0);
    close_to(s.volume, 4e-3 * 8e-3 * 12e-3, 1e-13);
    assert_int_equal(dem_make_hull(&s, 25, x, 0.05, 0.0, NULL, &reason), DEM_BAD_ARGUMENT);
    assert_non_null(strstr(reason, "one plane"));
    assert_int_equal(dem_make_hull(&s, 3, x, 0.05, 0.0, NULL, &reason), DEM_BAD_ARGUMENT);
    x[100] = HUGE_VAL;
    assert_int_equal(dem_make_hull(&s, 125, x, 0.05, 0.0, NULL, &reason), DEM_BAD_ARGUMENT);
    for (int k = 0; k < 30; k++) x[k] = 0.25;
    assert_int_equal(dem_make_hull(&s, 10, x, 0.05, 0.0, NULL, &reason), DEM_BAD_ARGUMENT);
}

/* Memory that runs out at any time is told, and all is freed. */
typedef struct counted {
    int left;
    size_t held;
} counted;
static void *count_memory(void *user, void *old, size_t old_size, size_t new_size) {
    counted *c = (counted *)user;
    if (new_size > 0 && c->left-- <= 0) return NULL;
    c->held += new_size - old_size;
    if (new_size > 0) return realloc(old, new_size);
    free(old);
    return NULL;
}
static void test_hull_memory(void **state) {
    (void)state;
    double x[3 * POINTS];
    dem_status status = DEM_OUT_OF_MEMORY;
    rock(x, 60, 1.0);
    for (int n = 0; status == DEM_OUT_OF_MEMORY; n++) {
        counted c = {n, 0};
        const dem_allocator allocator = {count_memory, &c};
        dem_convex s;
        status = dem_make_hull(&s, 60, x, 0.05, 0.0, &allocator, NULL);
        assert_true(c.held == 0 && n < 20 && (status == DEM_OK || n < 6));
    }
    assert_int_equal(status, DEM_OK);
}

/* Ready shapes have the volume of the round body, its moments and lengths to the error of 16 sides and of caps of 58
   corners, in any unit; wrong lengths are refused. */
static void test_ready(void **state) {
    (void)state;
    const char *reason = NULL;
    const double lengths[][3] = {{8, 4, 4}, {8, 4, 2}, {8, 4, 0}, {8, 8, 0}, {1, 10, 10}, {8, 1, 0.9}, {8, 4, 3.9999}};
    for (int trial = 0; trial < 14; trial++) {
        const double unit = trial < 7 ? 1e-3 : 1.0, *l = lengths[trial % 7], d = unit * l[0], h = unit * l[1],
                     band = unit * l[2];
        const double cap = 0.5 * (h - band), r = 0.5 * d, pi = RIDDLE_PI;
        /* about z; caps by Simpson's rule, whose error is that of r^4 */
        double volume = pi * r * r * band, along = 0.5 * volume * r * r;
        const double ball = cap > 0.0 ? 0.5 * (r * r + cap * cap) / cap : 0.0;
        for (int k = 0; k <= 200 && cap > 0.0; k++) {
            const double z = cap * k / 200.0 + ball - cap, square = ball * ball - z * z,
                         weight = cap / 600.0 *
                                  (k % 200 == 0 ? 1.0
                                   : k % 2      ? 4.0
                                                : 2.0);
            volume += 2.0 * weight * pi * square, along += 2.0 * weight * 0.5 * pi * square * square;
        }
        dem_convex s;
        assert_int_equal(dem_make_tablet(&s, d, h, band, 0.05, &reason), DEM_OK);
        close_to(s.volume, volume, 1e-9);
        double about = 0.0;
        for (int a = 0; a < 3; a++) about += s.moment[a] * s.axis[a].z * s.axis[a].z;
        close_to(about, along, cap > 0.0 ? 0.05 : 0.005);
        near(support(&s, dem_vec3(0, 0, 1)), 0.5 * h, s.deviation + (cap > 0.0 ? 0.04 : 1e-9) * 0.5 * h);
        near(support(&s, dem_vec3(1, 0, 0)), r, s.deviation + 0.04 * r);
        assert_true(dem__length(s.centroid) < 1e-3 * d);
    }
    dem_convex s, other;
    const double bad[][3] = {{0, 1, 1}, {1, 0, 0}, {1, 1, 2}, {1, 1, -1}, {1, 2, 0.5}, {NAN, 1, 1}, {1, 1, NAN}};
    for (int k = 0; k < 7; k++)
        assert_int_equal(dem_make_tablet(&s, bad[k][0], bad[k][1], bad[k][2], 0.05, &reason), DEM_BAD_ARGUMENT);
    for (int n = 6; n <= 300; n += n < 20 ? 1 : 70) {
        for (int grain = 0; grain < 3; grain++) {
            assert_int_equal(dem_make_gravel(&s, 5e-3, 0.7, 0.6, n, (uint64_t)grain, 0.05, &reason), DEM_OK);
            close_to(s.volume, RIDDLE_PI / 6.0 * 125e-9, 1e-9);
            assert_int_equal(s.given, n);
            assert_int_equal(dem_make_gravel(&other, 5e-3, 0.7, 0.6, n, (uint64_t)grain + 100, 0.05, &reason), DEM_OK);
            assert_true(other.moment[0] != s.moment[0]);
        }
        double moment[3] = {s.moment[0], s.moment[1], s.moment[2]}; /* of an ellipsoid: b^2 + c^2 and so on */
        in_order(moment);
        if (n > 100)
            close_to(moment[0] / moment[2], (0.49 + 0.1764) / (1.0 + 0.49), 0.05),
                close_to(moment[1] / moment[2], (1.0 + 0.1764) / (1.0 + 0.49), 0.05);
    }
    assert_int_equal(dem_make_gravel(&s, 5e-3, 0.05, 0.6, 12, 1, 0.05, &reason), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_gravel(&s, 5e-3, 0.5, 1.1, 12, 1, 0.05, &reason), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_gravel(&s, 5e-3, 0.5, 0.6, 5, 1, 0.05, &reason), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_gravel(&s, -1.0, 0.5, 0.6, 12, 1, 0.05, &reason), DEM_BAD_ARGUMENT);
    dem_clump pill;
    for (double length = 2e-3; length < 19.6e-3; length += 1.3e-3) {
        assert_int_equal(dem_make_capsule(&pill, 2e-3, length), DEM_OK);
        close_to(pill.volume, RIDDLE_PI * 1e-6 * (length - 2e-3 + 4e-3 / 3.0), 0.008);
    }
    assert_int_equal(dem_make_capsule(&pill, 2e-3, 1.9e-3), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_capsule(&pill, 2e-3, 21e-3), DEM_TOO_MANY);
}

/* A closed surface of 60 corners, as of an STL file. */
static void test_large_mesh(void **state) {
    (void)state;
    double x[3 * POINTS];
    static slow_hull h;
    dem_convex s;
    dem_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    rock(x, 60, 1.0), find_slowly(&h, x, 60);
    mesh.vertices = 60, mesh.triangles = h.faces, mesh.vertex = x, mesh.triangle = h.face[0];
    assert_int_equal(dem_make_convex_mesh(&s, &mesh, 0.03, NULL), DEM_OK);
    has_moments(&s, &h, 1e-12);
}

/* ---- distances ---- */

static double clamped(double t) { return t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t; }

/* Distance of two segments: the least over the inner crossing and the four ends. */
static double of_segments(dem_vec p, dem_vec p1, dem_vec q, dem_vec q1) {
    const dem_vec u = dem__sub(p1, p), v = dem__sub(q1, q), w = dem__sub(p, q);
    const double a = dem__dot(u, u), b = dem__dot(u, v), c = dem__dot(v, v), d = dem__dot(u, w), e = dem__dot(v, w),
                 det = a * c - b * b;
    double least = HUGE_VAL;
    for (int k = 0; k < 5; k++) {
        double s, t;
        if (k == 0) {
            if (!(det > 1e-14 * a * c)) continue;
            s = (b * e - c * d) / det, t = (a * e - b * d) / det;
            if (s < 0.0 || s > 1.0 || t < 0.0 || t > 1.0) continue;
        } else if (k < 3) s = k - 1.0, t = clamped((e + s * b) / c);
        else t = k - 3.0, s = clamped((t * b - d) / a);
        const double l = dem__length(dem__add(w, dem__sub(dem__scale(s, u), dem__scale(t, v))));
        least = l < least ? l : least;
    }
    return least;
}

/* Distance of two cores that do not overlap: the least over corners at faces and edges at edges. */
static double by_features(const dem_convex *a, const dem__placed *pa, const dem_convex *b, const dem__placed *pb) {
    double least = HUGE_VAL;
    dem_vec n;
    for (int k = 0; k < a->corners; k++) {
        const double d = dem__from_faces(b, dem__into_core(pb, dem__sub(dem__corner_at(a, pa, k), pb->x)), &n);
        least = d < least ? d : least;
    }
    for (int k = 0; k < b->corners; k++) {
        const double d = dem__from_faces(a, dem__into_core(pa, dem__sub(dem__corner_at(b, pb, k), pa->x)), &n);
        least = d < least ? d : least;
    }
    for (int e = 0; e < a->edges; e++) {
        for (int f = 0; f < b->edges; f++) {
            const double d = of_segments(dem__corner_at(a, pa, a->edge[e][0]), dem__corner_at(a, pa, a->edge[e][1]),
                                         dem__corner_at(b, pb, b->edge[f][0]), dem__corner_at(b, pb, b->edge[f][1]));
            least = d < least ? d : least;
        }
    }
    return least;
}

/* Do two cores overlap? By all axes. */
static double by_axes(const dem_convex *a, const dem__placed *pa, const dem_convex *b, const dem__placed *pb) {
    dem__gap_of_cores gap;
    dem__least_overlap(a, pa, b, pb, &gap);
    return gap.separation;
}

static void pick(dem_convex *s, int kind) {
    switch (kind) {
    case 0: brick(s); break;
    case 1: octahedron(s, 0.8); break;
    case 2: tetrahedron(s, 1.5, 0.03); break;
    default: prism(s); break;
    }
}

static void test_gap_against_features(void **state) {
    (void)state;
    double worst = 0.0;
    int apart = 0, overlapping = 0;
    for (int n = 0; n < 20000; n++) {
        dem_convex a, b;
        dem__gap_of_cores gap;
        dem__nearest_cache cache;
        if (n % 100 == 0) memset(&cache, 0, sizeof cache);
        pick(&a, n / 100 % 4), pick(&b, n / 400 % 4);
        const dem__placed pa = anyhow(1.2), pb = anyhow(0.0);
        dem__find_gap(&a, &pa, &b, &pb, HUGE_VAL, &cache, &gap);
        const double separated = by_axes(&a, &pa, &b, &pb);
        if (separated <= 0.0) {
            assert_true(gap.overlap || gap.separation < 1e-9);
            near(gap.separation, separated, 1e-9);
            overlapping++;
            continue;
        }
        const double exact = by_features(&a, &pa, &b, &pb), points = dem__length(dem__sub(gap.at_a, gap.at_b));
        assert_true(gap.separation <= exact + 1e-12);
        worst = fabs(points - exact) > worst ? fabs(points - exact) : worst;
        apart++;
    }
    assert_true(apart > 8000 && overlapping > 1000);
    assert_true(worst < 1e-7);
}

/* The box's own distance is that of any polyhedron. */
static void test_box_is_polyhedron(void **state) {
    (void)state;
    dem_convex s;
    brick(&s);
    for (int k = 0; k < 20000; k++) {
        const dem_vec p = dem_vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1.5, 1.5));
        dem_vec m, n;
        const double d = dem__from_box(s.half, p, HUGE_VAL, &m);
        near(d, dem__from_faces(&s, p, &n), 1e-14);
        if (fabs(d) > 1e-6 && d > 0.0) assert_true(dem__length(dem__sub(m, n)) < 1e-8);
    }
}

/* A point, a segment and a triangle at a brick, and a plane at its corners. */
static void test_simple_cores(void **state) {
    (void)state;
    dem_convex s, other;
    dem__placed p, q;
    dem__gap_of_cores gap;
    brick(&s);
    for (int n = 0; n < 5000; n++) {
        dem_vec x[3], normal;
        p = anyhow(0.1);
        for (int k = 0; k < 3; k++) x[k] = dem_vec3(uniform(-3, 3), uniform(-3, 3), uniform(-3, 3));
        dem__point_core(&other, &q, x[0], 0.1);
        dem__find_gap(&other, &q, &s, &p, HUGE_VAL, NULL, &gap);
        near(gap.separation, dem__from_core(&s, &p, x[0], HUGE_VAL, &normal), 1e-7);
        dem__segment_core(&other, &q, x[0], x[1], 0.1);
        dem__find_gap(&other, &q, &s, &p, HUGE_VAL, NULL, &gap);
        if (!gap.overlap) near(gap.separation, by_features(&other, &q, &s, &p), 1e-6);
        dem__triangle_core(&other, &q, x[0], x[1], x[2]);
        dem__find_gap(&other, &q, &s, &p, HUGE_VAL, NULL, &gap);
        if (!gap.overlap) near(gap.separation, by_features(&other, &q, &s, &p), 1e-6);
    }
}

/* ---- points of contact ---- */

static double potential(const dem_convex *a, const dem__placed *pa, const dem_convex *b, const dem__placed *pb,
                        dem_vec *force, dem_vec *torque_a, dem_vec *torque_b) {
    dem__gap_of_cores gap;
    dem__convex_point point[DEM__POINTS_MAX];
    double sum = 0.0;
    dem__find_gap(a, pa, b, pb, HUGE_VAL, NULL, &gap);
    const int n = dem__find_points(a, pa, b, pb, gap.normal, point);
    *force = *torque_a = *torque_b = dem_vec3(0, 0, 0);
    for (int k = 0; k < n; k++) {
        const dem_vec f = dem__scale(-point[k].weight * point[k].gap, point[k].normal);
        *force = dem__add(*force, f);
        *torque_a = dem__add(*torque_a, dem__cross(dem__sub(point[k].at, pa->x), f));
        *torque_b = dem__sub(*torque_b, dem__cross(dem__sub(point[k].at, pb->x), f));
        sum += 0.5 * point[k].weight * point[k].gap * point[k].gap;
    }
    return sum;
}

/* A little turn about the lab's axis k. */
static dem__placed nudged(const dem__placed *p, int k, double by) {
    dem__placed q = *p;
    if (k < 3) {
        *dem_axis_of(&q.x, k) += by;
        return q;
    }
    dem_vec about = dem_vec3(0, 0, 0);
    *dem_axis_of(&about, k - 3) = 1.0;
    for (int a = 0; a < 3; a++) {
        const dem_vec v = q.axis[a];
        q.axis[a] = dem__rotated(v, about, by);
    }
    return q;
}

/* Brings two bodies to touch lightly: along x, from far, by bisection. */
static int bring_together(const dem_convex *a, dem__placed *pa, const dem_convex *b, const dem__placed *pb,
                          double depth) {
    double out = 4.0, in = 0.0;
    for (int k = 0; k < 40; k++) {
        dem__gap_of_cores gap;
        pa->x.x = 0.5 * (out + in);
        dem__find_gap(a, pa, b, pb, HUGE_VAL, NULL, &gap);
        if (gap.separation > a->radius + b->radius - depth) out = pa->x.x;
        else in = pa->x.x;
    }
    return out < 3.9 && in > 0.0;
}

/* Forces and torques are the gradient of the potential, by central differences; momentum and angular
   momentum are kept. */
static void test_gradient(void **state) {
    (void)state;
    double worst = 0.0, unkept = 0.0;
    int tried = 0;
    for (int n = 0; n < 4000; n++) {
        dem_convex a, b;
        dem_vec f, ta, tb, g, ga, gb;
        pick(&a, n % 4), pick(&b, n / 4 % 4);
        dem__placed pa = anyhow(0.3), pb = anyhow(0.0);
        if (!bring_together(&a, &pa, &b, &pb, 0.01)) continue;
        const double u = potential(&a, &pa, &b, &pb, &f, &ta, &tb);
        if (u == 0.0) continue;
        const dem_vec balance = dem__add(dem__add(ta, tb), dem__cross(dem__sub(pa.x, pb.x), f));
        unkept = dem__length(balance) > unkept ? dem__length(balance) : unkept;
        const double h = 1e-7;
        for (int k = 0; k < 6; k++) {
            const dem__placed up = nudged(&pa, k, h), down = nudged(&pa, k, -h);
            const double slope =
                             (potential(&a, &up, &b, &pb, &g, &ga, &gb) - potential(&a, &down, &b, &pb, &g, &ga, &gb)) /
                             (2.0 * h),
                         against = k < 3 ? dem_axis(f, k) : dem_axis(ta, k - 3);
            worst = fabs(slope + against) > worst ? fabs(slope + against) : worst;
        }
        tried++;
    }
    print_message("gradient: %d pairs, largest deviation %.2g, of angular momentum %.2g\n", tried, worst, unkept);
    assert_true(tried > 2000);
    assert_true(unkept < 1e-14);
    assert_true(worst < 2e-6);
}

/* Everything that fits together: twins, faces on faces, edges on edges, corners on corners, all of it exactly and
   nearly. No NaN, and never more points than there is room for. RIDDLE_PAIRS sets how many. */
static void test_degenerate(void **state) {
    (void)state;
    const char *wanted = getenv("RIDDLE_PAIRS");
    const long pairs = wanted ? strtol(wanted, NULL, 10) : 40000;
    const double noise[] = {0.0, 0.0, 1e-17, 1e-12, 1e-8, 1e-4};
    dem_convex shape[4];
    for (int k = 0; k < 4; k++) pick(&shape[k], k);
    for (long n = 0; n < pairs; n++) {
        const dem_convex *a = &shape[n % 4], *b = &shape[n / 4 % 3 ? n % 4 : n / 12 % 4];
        const double e = noise[n / 7 % 6];
        const int i = (int)uniform(0, a->corners), j = (int)uniform(0, b->corners), kind = (int)(n / 5 % 4);
        dem__placed pb = placed(dem_vec3(0, 0, 0), 1.0, kind == 1 ? 1.0 : 0.0, 0.0, kind == 2 ? 1.0 : 0.0);
        dem__placed pa = placed(dem_vec3(0, 0, 0), 1.0 + uniform(-e, e), uniform(-e, e), uniform(-e, e),
                                uniform(-e, e) + (kind == 3));
        dem__gap_of_cores gap;
        dem__convex_point point[DEM__POINTS_MAX];
        dem__nearest_cache cache;
        memset(&cache, 0, sizeof cache);
        /* corner i of a, at, or a gap beyond, corner j of b; or faces on each other */
        const dem_vec from = dem__corner_at(a, &pa, i), to = dem__corner_at(b, &pb, j);
        pa.x = dem__sub(to, from);
        if (n % 3 == 0) pa.x = dem__scale(1.0 + 0.05 * uniform(-1, 1), pa.x);
        if (n % 3 == 1)
            pa.x = dem_vec3(uniform(-0.2, 0.2) * (double)(n % 2), 0.0,
                            2.0 * b->corner[0][2] * (n % 5 > 1 ? -1.0 : 1.0) + e);
        dem__find_gap(a, &pa, b, &pb, HUGE_VAL, n % 2 ? &cache : NULL, &gap);
        const int count = dem__find_points(a, &pa, b, &pb, gap.normal, point);
        assert_true(count >= 0 && count <= DEM__POINTS_MAX);
        assert_true(fabs(gap.separation) < 10.0);
        near(dem__length(gap.normal), 1.0, 1e-9);
        for (int k = 0; k < count; k++) {
            assert_true(point[k].gap < 0.0 && point[k].gap > -10.0);
            assert_true(point[k].weight >= -1.0 - 1e-9 && point[k].weight <= 1.0 + 1e-9);
            near(dem__length(point[k].normal), 1.0, 1e-9);
            assert_true(dem__length(point[k].at) < 10.0);
            if (k > 0) assert_true(point[k].key > point[k - 1].key);
        }
    }
}

/* A brick on a larger one has four points; crosswise on its like, four crossings of edges; and while it tilts, the
   force and its moment change without a jump. */
static void test_face_on_face(void **state) {
    (void)state;
    dem_convex a, b;
    dem__gap_of_cores gap;
    dem__convex_point point[DEM__POINTS_MAX];
    dem_vec f, ta, tb, f0 = dem_vec3(0, 0, 0), t0 = f0;
    brick(&a);
    assert_int_equal(dem_make_brick(&b, dem_vec3(3.0, 3.0, 1.0), 0.03, NULL), DEM_OK);
    dem__placed pb = placed(dem_vec3(0, 0, 0), 1, 0, 0, 0),
                pa = placed(dem_vec3(0.1, 0.2, 0.5 + 1.04 - 0.002), 1, 0, 0, 0.3);
    dem__find_gap(&a, &pa, &b, &pb, HUGE_VAL, NULL, &gap);
    assert_int_equal(dem__find_points(&a, &pa, &b, &pb, gap.normal, point), 4);
    for (int k = 0; k < 4; k++) near(point[k].gap, -0.002, 1e-12);
    b = a;
    pb = placed(dem_vec3(0, 0, 0), 1, 1, 0, 0); /* both lie, one along y, one along x */
    pa = placed(dem_vec3(0.03, 0.02, 0.998), 1, 0, 1, 0);
    dem__find_gap(&a, &pa, &b, &pb, HUGE_VAL, NULL, &gap);
    assert_int_equal(dem__find_points(&a, &pa, &b, &pb, gap.normal, point), 4);
    for (int k = 0; k < 4; k++) {
        near(point[k].gap, -0.002, 1e-12);
        near(point[k].weight, 1.0 / a.springs, 1e-12);
    }
    for (int way = 0; way < 3; way++) {
        for (int n = -2000; n <= 2000; n++) {
            const double tilt = 2e-5 * n;
            const dem__placed q = nudged(&pa, 3 + way, tilt);
            potential(&a, &q, &b, &pb, &f, &ta, &tb);
            if (n > -2000) assert_true(dem__length(dem__sub(f, f0)) < 1.5e-4 && dem__length(dem__sub(ta, t0)) < 1.5e-4);
            f0 = f, t0 = ta;
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mass),
        cmocka_unit_test(test_turned),
        cmocka_unit_test(test_erosion),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_mesh),
        cmocka_unit_test(test_hulls),
        cmocka_unit_test(test_round_prism),
        cmocka_unit_test(test_same_hull),
        cmocka_unit_test(test_hull_options),
        cmocka_unit_test(test_hull_memory),
        cmocka_unit_test(test_large_mesh),
        cmocka_unit_test(test_ready),
        cmocka_unit_test(test_gap_against_features),
        cmocka_unit_test(test_box_is_polyhedron),
        cmocka_unit_test(test_simple_cores),
        cmocka_unit_test(test_gradient),
        cmocka_unit_test(test_degenerate),
        cmocka_unit_test(test_face_on_face),
    };
    if (getenv("RIDDLE_TEST")) cmocka_set_test_filter(getenv("RIDDLE_TEST"));
    return cmocka_run_group_tests(tests, NULL, NULL);
}
