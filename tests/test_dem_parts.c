/* Compounds, bodies of several convex parts: mass, motion, contacts, and that they count as one body. */
#include "dem.h"
#include "dem_io.h"
#include "../examples/common/random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#include "failing_allocator.h"
#include "near.h"

enum { LINEAR = DEM_LINEAR | DEM_FRICTION, BOOKED = LINEAR | DEM_ENERGY };
static const dem_vec down = {0, 0, -9.81}, none = {0, 0, 0};
static uint64_t seed = 1;
static double uniform(double low, double high) { return low + (high - low) * random_plain(&seed); }
static dem_vec any_vector(double size) {
    return dem_vec3(uniform(-size, size), uniform(-size, size), uniform(-size, size));
}
static void turned(double q[4]) {
    for (int a = 0; a < 4; a++) q[a] = uniform(-1, 1);
}
static dem_def definition(double dt, double k, double e, double mu, dem_vec gravity) {
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 1000.0, 1e9, 0.3);
    dem_pair_def *pair = dem_pair(&def, m, m);
    pair->stiffness = k, pair->restitution = e, pair->friction = mu, pair->tangential_damping = 1.0;
    def.dt = dt, def.gravity = gravity;
    return def;
}
/* By names that the compiler knows, so that it compiles only these kernels. */
static void run(dem_world *w, double time, int is_hertz) {
    const dem_status status =
        is_hertz ? dem_run(w, time, DEM_HERTZ | DEM_FRICTION | DEM_ENERGY) : dem_run(w, time, BOOKED);
    assert_int_equal(status, DEM_OK);
}
static void start(dem_world *w, dem_def def) { assert_int_equal(dem_init(w, &def, NULL), DEM_OK); }

/* A box by its lower corner and its lengths, in the frame of the whole body [mm]. */
typedef struct box {
    double low[3], size[3];
} box;
static const box ell[2] = {{{0, 0, 0}, {6, 2, 2}}, {{0, 2, 0}, {2, 5, 2}}},
                 hook[3] = {{{-4, -1, 0}, {8, 2, 2}}, {{-4, -1, 2}, {2, 2, 8}}, {{2, -1, 2}, {2, 2, 8}}},
                 cross[5] = {{{-1, -1, -1}, {2, 2, 2}},
                             {{1, -1, -1}, {4, 2, 2}},
                             {{-5, -1, -1}, {4, 2, 2}},
                             {{-1, 1, -1}, {2, 4, 2}},
                             {{-1, -5, -1}, {2, 4, 2}}};

static void make_box(dem_convex *s, const box *b) {
    double x[8][3], least = b->size[0];
    for (int a = 1; a < 3; a++) least = b->size[a] < least ? b->size[a] : least;
    for (int k = 0; k < 24; k++) x[k / 3][k % 3] = 1e-3 * (b->low[k % 3] + (k / 3 >> k % 3 & 1) * b->size[k % 3]);
    assert_int_equal(dem_make_convex(s, 8, x[0], 0.1 / least, NULL), DEM_OK);
}
static dem_compound make(dem_world *w, const box *b, int n) {
    dem_convex part[DEM_PARTS_MAX];
    dem_compound c;
    const char *reason = NULL;
    for (int k = 0; k < n; k++) make_box(&part[k], &b[k]);
    if (dem_make_compound(w, n, part, NULL, NULL, &c, &reason) != DEM_OK) fail_msg("%s", reason ? reason : "?");
    return c;
}
/* Cuts a box into nx ny 1 parts. */
static void cut_box(const box *whole, int nx, int ny, box *part) {
    for (int k = 0; k < nx * ny; k++) {
        part[k] = *whole;
        part[k].size[0] /= nx, part[k].size[1] /= ny;
        part[k].low[0] += k % nx * part[k].size[0], part[k].low[1] += k / nx * part[k].size[1];
    }
}
/* Adds one body. Returns its first particle. */
static ptrdiff_t put(dem_world *w, const dem_compound *c, dem_vec x, const double *q) {
    const double at[3] = {x.x, x.y, x.z};
    assert_int_equal(dem_add_compounds(w, 1, c, at, q, 0, 0), DEM_OK);
    return w->count - c->parts;
}
static double energy(const dem_world *w) {
    const dem_energy_ledger e = dem_energy(w);
    return e.kinetic + e.rotational + e.elastic + e.potential;
}

/* ---- mass ---- */

/* Those of the boxes by closed forms; parts given in frames of their own, and cut into more parts, make the same. */
static void test_mass(void **state) {
    (void)state;
    dem_world w;
    double v = 0.0, m[3] = {0, 0, 0}, square[3] = {0, 0, 0}, xy = 0.0;
    start(&w, definition(1e-6, 1e4, 1.0, 0.0, none));
    const dem_compound c = make(&w, ell, 2);
    for (int k = 0; k < 2; k++) {
        double x[3], own = 1.0;
        for (int a = 0; a < 3; a++) x[a] = 1e-3 * (ell[k].low[a] + 0.5 * ell[k].size[a]), own *= 1e-3 * ell[k].size[a];
        v += own, xy += own * x[0] * x[1];
        for (int a = 0; a < 3; a++)
            m[a] += own * x[a], square[a] += own * (x[a] * x[a] + 1e-6 * ell[k].size[a] * ell[k].size[a] / 12.0);
    }
    close_to(c.volume, v, 1e-13);
    for (int a = 0; a < 3; a++) near(dem_axis(c.origin, a), m[a] / v, 1e-16), square[a] -= m[a] * m[a] / v;
    xy -= m[0] * m[1] / v;
    const double middle = 0.5 * (square[0] + square[1]) + square[2],
                 spread = sqrt(0.25 * (square[0] - square[1]) * (square[0] - square[1]) + xy * xy),
                 wanted[3] = {middle - spread, middle + spread, square[0] + square[1]};
    for (int a = 0; a < 3; a++) {
        double least = HUGE_VAL;
        for (int b = 0; b < 3; b++) least = fmin(least, fabs(dem_axis(c.moments, b) / wanted[a] - 1.0));
        assert_true(least < 1e-12);
    }
    /* each part in a frame of its own */
    dem_convex part[2];
    double place[2][3], turn[2][4];
    for (int k = 0; k < 2; k++) {
        double x[8][3];
        dem_quaternion q;
        turned(turn[k]);
        assert_true(dem__unit_turn(dem__quaternion(turn[k][0], dem_vec3(turn[k][1], turn[k][2], turn[k][3])), &q));
        const dem_vec at = any_vector(5e-3);
        place[k][0] = at.x, place[k][1] = at.y, place[k][2] = at.z;
        for (int n = 0; n < 8; n++) {
            dem_vec y;
            for (int a = 0; a < 3; a++) *dem_axis_of(&y, a) = 1e-3 * (ell[k].low[a] + (n >> a & 1) * ell[k].size[a]);
            y = dem__to_body(q, dem__sub(y, at));
            x[n][0] = y.x, x[n][1] = y.y, x[n][2] = y.z;
        }
        assert_int_equal(dem_make_convex(&part[k], 8, x[0], 0.05, NULL), DEM_OK);
    }
    dem_compound d;
    assert_int_equal(dem_make_compound(&w, 2, part, place[0], turn[0], &d, NULL), DEM_OK);
    box pieces[24];
    cut_box(&ell[0], 6, 2, pieces), cut_box(&ell[1], 2, 3, pieces + 12);
    const dem_compound e = make(&w, pieces, 18), *other[2] = {&d, &e};
    for (int k = 0; k < 2; k++) {
        close_to(other[k]->volume, c.volume, 1e-12);
        near(dem__length(dem__sub(other[k]->origin, c.origin)), 0.0, 1e-15);
        near(dem__length(dem__sub(other[k]->moments, c.moments)), 0.0, 1e-12 * c.moments.x);
    }
    dem_free(&w);
}

static void test_refusals(void **state) {
    (void)state;
    static const box twice[2] = {{{0, 0, 0}, {6, 2, 2}}, {{1, 0, 0}, {6, 2, 2}}};
    dem_world w;
    dem_convex part[DEM_PARTS_MAX + 1];
    dem_compound c, bad;
    const char *reason;
    const double at[3] = {0, 0, 0}, wrong[3] = {0, NAN, 0}, no_turn[8] = {0, 0, 0, 0, 1, 0, 0, 0};
    const double nowhere[6] = {0, 0, 0, HUGE_VAL, 0, 0};
    start(&w, definition(1e-6, 1e4, 1.0, 0.0, none));
    for (int k = 0; k < 2; k++) make_box(&part[k], &twice[k]);
    assert_int_equal(dem_make_compound(&w, 2, part, NULL, NULL, &c, &reason), DEM_BAD_ARGUMENT);
    assert_non_null(strstr(reason, "centroid"));
    for (int k = 0; k < 2; k++) make_box(&part[k], &ell[k]);
    assert_int_equal(dem_make_compound(&w, 0, part, NULL, NULL, &c, NULL), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_compound(NULL, 2, part, NULL, NULL, &c, NULL), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_compound(&w, DEM_PARTS_MAX + 1, part, NULL, NULL, &c, NULL), DEM_TOO_MANY);
    assert_int_equal(dem_make_compound(&w, 2, part, nowhere, NULL, &c, &reason), DEM_BAD_ARGUMENT);
    assert_non_null(reason);
    assert_int_equal(dem_make_compound(&w, 2, part, NULL, no_turn, &c, &reason), DEM_BAD_ARGUMENT);
    part[1].radius = -1.0;
    assert_int_equal(dem_make_compound(&w, 2, part, NULL, NULL, &c, &reason), DEM_BAD_ARGUMENT);
    assert_int_equal(w.engine->convex.shapes, 0);
    c = make(&w, ell, 2);
    bad = c, bad.shape[1] = 2;
    assert_int_equal(dem_add_compounds(&w, 1, &bad, at, NULL, 0, 0), DEM_BAD_ARGUMENT);
    bad = c, bad.parts = DEM_PARTS_MAX + 1;
    assert_int_equal(dem_add_compounds(&w, 1, &bad, at, NULL, 0, 0), DEM_BAD_ARGUMENT);
    bad = c, bad.moments.x = NAN;
    assert_int_equal(dem_add_compounds(&w, 1, &bad, at, NULL, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_compounds(&w, 1, &c, wrong, NULL, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_compounds(&w, 1, &c, at, no_turn, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_compounds(&w, 1, &c, at, NULL, 1, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_compounds(&w, PTRDIFF_MAX / 8, &c, at, NULL, 0, 0), DEM_TOO_MANY);
    assert_int_equal(w.count, 0);
    dem_free(&w);
}

/* ---- as the polyhedron itself ---- */

/* A box between two planes: as a polyhedron (0), as a compound of one part (1), or cut into parts. */
static void build_box(dem_world *w, int parts, double e, double mu, const double *q) {
    static const box whole = {{0, 0, 0}, {4, 3, 2}};
    const double at[3] = {0, 0, 4e-3};
    box part[DEM_PARTS_MAX];
    start(w, definition(2e-6, 2e4, e, mu, down));
    dem_add_plane(w, 0, none, dem_vec3(0, 0, 1));
    dem_add_plane(w, 0, none, dem_vec3(0.6, 0, 0.8));
    if (parts == 0) {
        dem_convex s;
        make_box(&s, &whole);
        assert_int_equal(dem_add_convex(w, dem_add_shape(w, &s), 1, at, q, 0, 0), DEM_OK);
    } else {
        cut_box(&whole, parts, 1, part);
        const dem_compound c = make(w, part, parts);
        put(w, &c, dem__point(at), q);
    }
    assert_int_equal(dem_set_motion(w, 0, dem_vec3(0.1, 0.05, -0.2), dem_vec3(40, 30, -20)), DEM_OK);
}
static void test_one_part(void **state) {
    (void)state;
    for (int n = 0; n < 6; n++) {
        dem_world w[3];
        double q[4];
        turned(q);
        for (int k = 0; k < 3; k++) {
            build_box(&w[k], k, 0.7, 0.4, q);
            assert_int_equal(dem_run(&w[k], 0.005, LINEAR), DEM_OK);
        }
        const dem_body flying = dem_get_body(&w[0], 0), cut = dem_get_body(&w[2], 0);
        if (w[0].contact_steps == 0) { /* free flight is the same, however the body is cut */
            near(dem__length(dem__sub(flying.position, cut.position)), 0.0, 1e-14);
            near(dem__length(dem__sub(flying.spin, cut.spin)), 0.0, 1e-10);
        }
        for (int k = 0; k < 2; k++) assert_int_equal(dem_run(&w[k], 0.035, LINEAR), DEM_OK);
        assert_true(w[0].contact_steps > 100);
        const dem_body a = dem_get_body(&w[0], 0), b = dem_get_body(&w[1], 0);
        near(dem__length(dem__sub(a.position, b.position)), 0.0, 1e-12);
        near(dem__length(dem__sub(a.spin, b.spin)), 0.0, 1e-8);
        near(a.orientation.w, b.orientation.w, 1e-9), near(a.orientation.x, b.orientation.x, 1e-9);
        for (int k = 0; k < 3; k++) dem_free(&w[k]);
    }
}

/* Faces that land flat have the restitution of the pair, however many parts they are drawn with. */
static void test_flat_landing(void **state) {
    (void)state;
    static const box slab = {{-4, -3, -1}, {8, 6, 2}};
    for (int n = 0; n < 12; n++) {
        const double e = n / 2 % 2 ? 0.3 : 0.9;
        box part[16];
        dem_world w;
        double deep = 0.0;
        start(&w, definition(1e-6, 2e4, e, 0.0, none));
        dem_add_plane(&w, 0, none, dem_vec3(0, 0, 1));
        cut_box(&slab, 4, 4, part);
        const dem_compound c = n < 4 ? make(&w, &slab, 1) : n < 8 ? make(&w, part, 16) : make(&w, cross, 5);
        put(&w, &c, dem_vec3(0, 0, 1.002e-3), NULL);
        assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0, 0, -0.1), none), DEM_OK);
        for (int q = 0; q < 700; q++) {
            run(&w, 1e-6, n % 2);
            deep = fmax(deep, 1e-3 - dem_get_body(&w, 0).position.z);
        }
        const dem_body b = dem_get_body(&w, 0);
        near(b.velocity.z, 0.1 * e, 5e-4);
        near(dem__length(b.spin), 0.0, 1e-9);
        const double soft = 0.95 * 0.1 * sqrt(b.mass / 2e4); /* a face of several parts has up to twice the stiffness */
        if (n % 2 == 0 && e == 0.9) close_to(deep, soft * (n < 4 ? 1.0 : sqrt(0.5)), 0.02);
        dem_free(&w);
    }
}

/* ---- energy and momentum ---- */

/* An L that tumbles between six walls, without losses. */
static void test_tumble(void **state) {
    (void)state;
    for (int n = 0; n < 4; n++) {
        const dem_def def = definition(5e-7, 1e5, 1.0, 0.0, down);
        dem_world w;
        double q[4];
        start(&w, def);
        for (int a = 0; a < 6; a++) {
            dem_vec normal = none;
            *dem_axis_of(&normal, a / 2) = a % 2 ? -1 : 1;
            dem_add_plane(&w, 0, dem__scale(-0.008, normal), normal);
        }
        const dem_compound c = n < 2 ? make(&w, ell, 2) : make(&w, hook, 3);
        turned(q);
        put(&w, &c, none, q);
        assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0.3, 0.4, 0.2), dem_vec3(100, -50, 30)), DEM_OK);
        run(&w, 0.0, n % 2);
        const double begin = energy(&w);
        for (int k = 0; k < 6; k++) {
            run(&w, 0.01, n % 2);
            close_to(energy(&w), begin, 1e-3);
        }
        assert_true(w.contact_steps > 500 && dem_core_overlap_steps(&w) == 0);
        dem_free(&w);
    }
}

static dem_vec angular_momentum(const dem_world *w, ptrdiff_t i) {
    const dem_body b = dem_get_body(w, i);
    const dem_vec own = dem__to_body(b.axes, b.spin);
    const dem_vec momentum = dem_vec3(b.moments.x * own.x, b.moments.y * own.y, b.moments.z * own.z);
    return dem__plus(dem__to_lab(b.axes, momentum), b.mass, dem__cross(b.position, b.velocity));
}
/* A hook and a cross hit each other, several parts at a time: momentum, angular momentum and energy are kept. */
static void test_hits(void **state) {
    (void)state;
    int hits = 0, several = 0;
    for (int n = 0; n < 20; n++) {
        const double e = n < 12 ? 1.0 : 0.6, mu = n < 12 ? 0.0 : 0.4;
        dem_world w;
        double q[4];
        start(&w, definition(1e-6, 2e4, e, mu, none));
        const dem_compound c = make(&w, hook, 3), d = make(&w, cross, 5);
        turned(q), put(&w, &c, none, q);
        turned(q);
        const ptrdiff_t j = put(&w, &d, dem_vec3(0.014, uniform(-2e-3, 2e-3), uniform(-2e-3, 2e-3)), q);
        assert_int_equal(dem_set_motion(&w, 0, dem_vec3(1, 0, 0), any_vector(50)), DEM_OK);
        assert_int_equal(dem_set_motion(&w, j, none, any_vector(50)), DEM_OK);
        run(&w, 0.0, n % 2);
        const double begin = energy(&w);
        const dem_vec p = dem_momentum(&w), l = dem__add(angular_momentum(&w, 0), angular_momentum(&w, j));
        for (int k = 0; k < 120; k++) {
            run(&w, 1e-4, n % 2);
            several += dem_contact_count(&w) > 1;
        }
        hits += w.contact_steps > 0;
        near(dem__length(dem__sub(dem_momentum(&w), p)), 0.0, 1e-13 * dem__length(p));
        near(dem__length(dem__sub(dem__add(angular_momentum(&w, 0), angular_momentum(&w, j)), l)), 0.0,
             1e-12 * dem__length(l));
        if (e == 1.0) close_to(energy(&w), begin, 1e-4);
        else assert_true(energy(&w) < begin * (1.0 + 1e-9) && fabs(dem_energy(&w).error) < 2e-3 * begin);
        assert_int_equal(dem_core_overlap_steps(&w), 0);
        dem_free(&w);
    }
    print_message("    %d hits, %d of several points\n", hits, several);
    assert_true(hits >= 12 && several > 3);
}

/* ---- at rest ---- */

/* An L, a cross and a hook fall on a plane and come to rest; the plane carries their weight. */
static void test_rest(void **state) {
    (void)state;
    for (int n = 0; n < 3; n++) {
        dem_world w;
        dem_vec force = none;
        start(&w, definition(1e-6, 2e4, 0.3, 0.5, down));
        dem_add_plane(&w, 0, none, dem_vec3(0, 0, 1));
        const dem_compound c = n == 0 ? make(&w, ell, 2) : n == 1 ? make(&w, cross, 5) : make(&w, hook, 3);
        double q[4];
        turned(q);
        put(&w, &c, dem_vec3(0, 0, 8e-3), q);
        assert_int_equal(dem_set_time_step(&w, dem_advise(&w, LINEAR, 0.0).advised), DEM_OK);
        assert_int_equal(dem_run(&w, 0.25, BOOKED), DEM_OK);
        const dem_body b = dem_get_body(&w, 0);
        const dem_energy_ledger l = dem_energy(&w);
        const double weight = 9.81 * b.mass;
        assert_true(l.kinetic + l.rotational < 1e-12 * weight * 8e-3);
        assert_true(fabs(l.error) < 1e-3 * l.released);
        for (ptrdiff_t k = 0; k < dem_contact_count(&w); k++) {
            const dem_contact_info f = dem_get_contact(&w, k);
            force = dem__add(force, f.force);
            near(f.point.z, 0.0, 1e-6), near(f.normal.z, 1.0, 1e-12);
        }
        close_to(force.z, weight, 1e-6);
        near(dem__length(dem__add(force, dem__scale(b.mass, down))), 0.0, 1e-6 * weight);
        dem_free(&w);
    }
}

/* A hook hangs in another one, which is fixed, swings and comes to rest below it. */
static void test_hooks(void **state) {
    (void)state;
    dem_world w;
    const double hanging[4] = {0, 1, 1, 0}; /* opening down, across */
    start(&w, definition(2e-6, 2e4, 0.3, 0.5, down));
    const dem_compound c = make(&w, hook, 3);
    const double bar = 2e-3 - c.origin.z; /* of the upper one, its top */
    const ptrdiff_t low = put(&w, &c, none, NULL) + 3;
    put(&w, &c, dem_vec3(0, 0, 2.0 * bar + 1e-4), hanging);
    assert_int_equal(dem_fix(&w, 1, 1), DEM_OK);
    assert_int_equal(dem_set_motion(&w, low, dem_vec3(0.02, 0.05, 0), dem_vec3(10, 5, 10)), DEM_OK);
    for (int k = 0; k < 10; k++) {
        assert_int_equal(dem_run(&w, 0.05, LINEAR), DEM_OK);
        const dem_vec x = dem_get_body(&w, low).position;
        assert_true(fabs(x.x) < 4e-3 && fabs(x.y) < 4e-3 && x.z > 2.0 * bar - 2e-3 && x.z < 2.0 * bar + 2e-3);
    }
    const dem_body b = dem_get_body(&w, low);
    assert_true(dem__length(b.velocity) < 2e-2 && dem_contact_count(&w) > 0);
    assert_int_equal(dem_core_overlap_steps(&w), 0);
    assert_int_equal(dem_fix(&w, 1, 0), DEM_OK); /* both fall */
    assert_int_equal(dem_run(&w, 0.1, LINEAR), DEM_OK);
    near(dem_get_body(&w, 0).velocity.z, -0.981, 0.02), near(dem_get_body(&w, low).velocity.z, -0.981, 0.02);
    dem_free(&w);
}

/* ---- bits ---- */

static void put_others(dem_world *w, int k, dem_vec x) {
    const double at[3] = {x.x, x.y, x.z}, ends[6] = {0, 0, 0, 2e-3, 0, 0}, d[2] = {3e-3, 2e-3};
    static const box brick = {{-1, -1, -2}, {2, 2, 4}};
    dem_clump c;
    dem_convex s;
    if (k % 3 == 0) assert_int_equal(dem_add_spheres(w, 1, at, d, 0, 0), DEM_OK);
    if (k % 3 == 1)
        assert_int_equal(dem_make_clump(2, ends, d, &c), DEM_OK),
            assert_int_equal(dem_add_clumps(w, 1, &c, at, NULL, NULL, 0, 0), DEM_OK);
    if (k % 3 == 2)
        make_box(&s, &brick), assert_int_equal(dem_add_convex(w, dem_add_shape(w, &s), 1, at, NULL, 0, 0), DEM_OK);
}
/* Compounds and others in a drum that turns, most of them touching. */
static void drum(dem_world *w, int threads) {
    dem_def def = definition(2e-6, 2e4, 0.5, 0.5, dem_vec3(0, -9.81, 0));
    def.threads = threads;
    start(w, def);
    const int wall[3] = {dem_add_cylinder(w, 0, none, dem_vec3(0, 0, 1), 0.025, 1),
                         dem_add_plane(w, 0, none, dem_vec3(0, 0, 1)),
                         dem_add_plane(w, 0, dem_vec3(0, 0, 0.022), dem_vec3(0, 0, -1))};
    for (int k = 0; k < 3; k++) assert_int_equal(dem_rotate(w, wall[k], none, dem_vec3(0, 0, 1), 12.0), DEM_OK);
    const dem_compound c[3] = {make(w, ell, 2), make(w, cross, 5), make(w, hook, 3)};
    for (int k = 0; k < 18; k++) {
        const dem_vec x = dem_vec3(0.0105 * (k % 3 - 1), 0.0105 * (k / 3 % 3 - 1), 5.5e-3 + 0.011 * (k / 9));
        double q[4];
        turned(q);
        if (k % 6 == 5) put_others(w, k / 6, x);
        else put(w, &c[k % 3], x, q);
    }
}
/* Compounds that tumble, without gravity, about a box of triangles that turns in a tube, which is periodic along its
   axis: most of the time all fly. */
static void paddle(dem_world *w, int threads) {
    dem_def def = definition(2e-6, 2e4, 0.9, 0.5, none);
    def.threads = threads, def.periodic[2] = 1;
    def.low = dem_vec3(-0.04, -0.04, 0), def.high = dem_vec3(0.04, 0.04, 0.03);
    start(w, def);
    const int wall = dem_add_box(w, 0, dem_vec3(-0.028, -5e-4, -0.03), dem_vec3(0.028, 5e-4, 0.06));
    assert_int_equal(dem_rotate(w, wall, none, dem_vec3(0, 0, 1), 40.0), DEM_OK);
    assert_true(dem_add_cylinder(w, 0, none, dem_vec3(0, 0, 1), 0.035, 1) >= 0);
    const dem_compound c[2] = {make(w, ell, 2), make(w, hook, 3)};
    for (int k = 0; k < 16; k++) {
        const dem_vec x = dem_vec3(0.012 * (k % 4 - 1.5), k / 4 % 2 ? 0.009 : -0.009, 7e-3 + 0.015 * (k / 8));
        double q[4];
        const ptrdiff_t i = w->count;
        turned(q);
        if (k % 5 == 4) put_others(w, k, x);
        else put(w, &c[k % 2], x, q);
        assert_int_equal(dem_set_motion(w, i, any_vector(0.5), any_vector(300)), DEM_OK);
    }
}
/* The second run on two threads, saved half-way; the third tests everything in every step. */
static void in_scene(void (*build)(dem_world *w, int threads), double time) {
    uint64_t hash[3];
    for (int run = 0; run < 3; run++) {
        dem_world w, again;
        seed = 5;
        build(&w, run == 1 ? 2 : 1);
        if (run == 2) w.def.skip = 0;
        assert_int_equal(dem_run(&w, 0.5 * time, BOOKED), DEM_OK);
        if (run == 1) {
            const size_t size = dem_save(&w, NULL, 0);
            unsigned char *bytes = (unsigned char *)malloc(size);
            assert_int_equal(dem_save(&w, bytes, size), size);
            assert_int_equal(dem_load(&again, bytes, size, NULL), DEM_OK);
            for (ptrdiff_t i = 0; i < w.count; i++) {
                const dem_quaternion p = dem_shape_orientation(&w, i), q = dem_shape_orientation(&again, i);
                assert_memory_equal(&p, &q, sizeof p);
            }
            free(bytes);
            dem_free(&w), w = again;
        }
        assert_int_equal(dem_run(&w, 0.5 * time, BOOKED), DEM_OK);
        assert_true(w.contact_steps > 500 && dem_core_overlap_steps(&w) > 0); /* deep ones, too */
        const dem_energy_ledger l = dem_energy(&w);
        assert_true(fabs(l.error) < 5e-3 * (l.released + fabs(l.wall_work)));
        hash[run] = dem_hash(&w);
        dem_free(&w);
    }
    assert_true(hash[0] == hash[1] && hash[0] == hash[2]);
}
static void test_bits(void **state) {
    (void)state;
    in_scene(drum, 0.04);
    in_scene(paddle, 0.03);
}

/* ---- one body ---- */

static void test_counts_as_one(void **state) {
    (void)state;
    dem_world w;
    dem_io_surface surface;
    dem_measure m;
    dem_passed record[4];
    double psi[3];
    start(&w, definition(2e-6, 2e4, 0.5, 0.5, down));
    const dem_compound c = make(&w, ell, 2);
    const double q[4] = {1, 0.3, -0.2, 0.5};
    put(&w, &c, none, q), put(&w, &c, dem_vec3(0.03, 0, 0), NULL);
    assert_int_equal(w.count, 4);
    assert_int_equal(dem_get_body(&w, 3).first, 2), assert_int_equal(dem_get_body(&w, 0).pieces, 2);
    close_to(dem_mass(&w, 1), 1000.0 * c.volume, 1e-14);
    close_to(dem_get_body(&w, 0).diameter, riddle_cbrt(6.0 / RIDDLE_PI * c.volume), 1e-14);
    /* positions of parts; the surface in a picture lies where the boxes are */
    for (int k = 0; k < 2; k++)
        near(dem__length(dem__sub(dem__sub(dem_position(&w, 2 + k), dem_vec3(0.03, 0, 0)), c.centre[k])), 0.0, 1e-15);
    assert_int_equal(dem_io_polyhedra_of(&w, &surface), DEM_OK);
    dem_vec low = dem_vec3(1, 1, 1), high = dem_vec3(-1, -1, -1);
    for (int k = 0; k < surface.vertices; k++) {
        if (surface.wall[k] < 2) continue;
        for (int a = 0; a < 3; a++) {
            const double x = surface.vertex[3 * k + a];
            *dem_axis_of(&low, a) = fmin(dem_axis(low, a), x), *dem_axis_of(&high, a) = fmax(dem_axis(high, a), x);
        }
    }
    near(dem__length(dem__sub(low, dem__sub(dem_vec3(0.03, 0, 0), c.origin))), 0.0, 1e-12);
    near(dem__length(dem__sub(dem__sub(high, low), dem_vec3(6e-3, 7e-3, 2e-3))), 0.0, 1e-12);
    dem_io_free_surface(&surface);
    /* regions: a half of the second body's second part, exactly */
    dem_region r = dem_box_region(dem_vec3(-0.1, -0.1, -0.1), dem_vec3(0.1, 0.1, 0.1));
    assert_int_equal(dem_measure_region(&w, &r, &m), DEM_OK);
    assert_int_equal(m.count, 2);
    close_to(m.mass, 2000.0 * c.volume, 1e-12), close_to(m.solid_fraction, 2.0 * c.volume / 8e-3, 1e-9);
    const dem_vec corner = dem__sub(dem_vec3(0.03, 0, 0), c.origin);
    r = dem_box_region(dem__add(corner, dem_vec3(-1e-3, 4.5e-3, -1e-3)), dem__add(corner, dem_vec3(9e-3, 9e-3, 3e-3)));
    assert_int_equal(dem_measure_region(&w, &r, &m), DEM_OK);
    close_to(m.solid_fraction, 2e-3 * 2.5e-3 * 2e-3 / (10e-3 * 4.5e-3 * 4e-3), 1e-9);
    assert_int_equal(dem_body_sphericities(&w, 0, dem_vec3(1, 0, 0), psi), DEM_OK);
    assert_true(psi[0] == 1.0 && psi[1] == 1.0 && psi[2] == 1.0);
    /* turned as a whole */
    assert_int_equal(dem_set_orientation(&w, 3, dem__quaternion(1, dem_vec3(0, 0, 1))), DEM_OK);
    near(dem_shape_orientation(&w, 2).z, sqrt(0.5), 1e-12), near(dem_orientation(&w, 2).z, sqrt(0.5), 1e-12);
    /* one leaves as one, one is removed as one */
    assert_true(dem_add_exit(&w, dem_vec3(0, 0, -0.02), dem_vec3(0, 0, 1)) >= 0);
    r = dem_box_region(dem_vec3(-0.01, -0.01, -0.02), dem_vec3(0.01, 0.01, 0.02));
    assert_int_equal(dem_remove_region(&w, &r), 1);
    assert_int_equal(dem_run(&w, 0.1, LINEAR), DEM_OK);
    assert_int_equal(dem_take_passed(&w, record, 4), 1);
    close_to(record[0].diameter, riddle_cbrt(6.0 / RIDDLE_PI * c.volume), 1e-12);
    put_others(&w, 2, none); /* takes the place of a part */
    assert_int_equal(dem_run(&w, 0.001, LINEAR), DEM_OK);
    dem_free(&w);
}

/* ---- feeds ---- */

static dem_feed feed_of(const dem_compound *c) {
    dem_feed feed = dem_default_feed();
    feed.region = dem_box_region(none, dem_vec3(0.1, 0.1, 0.1));
    feed.velocity = dem_vec3(0.0, 0.1, -0.5);
    feed.compound = c;
    return feed;
}
/* Farthest corner of a body from its centre, as a feed keeps it clear. */
static double reach_of(const dem_world *w, const dem_compound *c) {
    double reach = 0.0;
    for (int k = 0; k < c->parts; k++)
        reach = fmax(reach, dem__length(c->centre[k]) + dem_get_shape(w, c->shape[k])->reach);
    return reach;
}

/* As many as asked, or their mass, within the region, apart by the spheres around them, turned in all directions,
   each counted once. Then another compound and a polyhedron take the feed over. */
static void test_feed(void **state) {
    (void)state;
    enum { N = 150 };
    dem_world w;
    start(&w, definition(2e-6, 2e4, 0.5, 0.5, none));
    const dem_compound c = make(&w, ell, 2), h = make(&w, hook, 3);
    const double one = 1000.0 * c.volume, far = reach_of(&w, &c);
    double along = 0.0;
    dem_feed feed = feed_of(&c);
    assert_int_equal(dem_fill(&w, &feed, N), DEM_OK);
    assert_int_equal(feed.placed, N), assert_int_equal(feed.missed, 0), assert_int_equal(w.count, 2 * N);
    close_to(feed.placed_mass, N * one, 1e-12);
    for (int i = 0; i < N; i++) {
        const dem_body a = dem_get_body(&w, 2 * i);
        assert_int_equal(a.first, 2 * i), assert_int_equal(a.pieces, 2);
        close_to(a.mass, one, 1e-13);
        near(dem__length(dem__sub(a.velocity, feed.velocity)), 0.0, 1e-15);
        for (int axis = 0; axis < 3; axis++)
            assert_true(dem_axis(a.position, axis) > far - 1e-12 && dem_axis(a.position, axis) < 0.1 - far + 1e-12);
        const dem_vec up = dem__to_lab(dem_orientation(&w, 2 * i), dem_vec3(0, 0, 1));
        along += up.z * up.z / N;
        for (int k = 0; k < i; k++)
            assert_true(dem__length(dem__sub(dem_get_body(&w, 2 * k).position, a.position)) > 2.0 * far - 1e-12);
    }
    near(along, 1.0 / 3.0, 0.1);
    run(&w, 2e-6, 0);
    assert_int_equal(dem_contact_count(&w), 0);
    /* a mass, at once and in time, from a face */
    feed.region = dem_box_region(dem_vec3(0, 0, 0.15), dem_vec3(0.1, 0.1, 0.15));
    assert_int_equal(dem_feed_mass(&w, &feed, 8.3 * one, 1.0), DEM_OK);
    assert_int_equal(w.count, 2 * (N + 8));
    close_to(feed.due_mass, 0.3 * one, 1e-9);
    feed.region = dem_box_region(dem_vec3(0, 0, 0.2), dem_vec3(0.1, 0.1, 0.25));
    assert_int_equal(dem_fill_mass(&w, &feed, 4.0 * one), DEM_OK);
    assert_int_equal(w.count, 2 * (N + 12));
    assert_int_equal(dem_fill_mass(&w, &feed, 1.0), DEM_TOO_MANY);
    /* the next has been drawn: another shape draws its own */
    feed.compound = &h;
    const double before = feed.placed_mass;
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_OK);
    close_to(feed.placed_mass - before, 1000.0 * h.volume, 1e-9);
    close_to(dem_mass(&w, w.count - 1), 1000.0 * h.volume, 1e-13), assert_int_equal(w.count, 2 * (N + 12) + 3);
    feed.compound = NULL, feed.polyhedron = 1 + c.shape[0];
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_OK);
    assert_int_equal(dem_get_body(&w, w.count - 1).pieces, 1);
    /* refused, without a trace */
    const ptrdiff_t count = w.count;
    dem_compound bad = c;
    feed.compound = &c;
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT); /* with a polyhedron */
    feed.polyhedron = 0, feed.compound = &bad;
    bad.shape[1] = 99;
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT);
    bad = c, bad.add__ = NULL;
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT);
    bad = c, bad.volume = (double)NAN;
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT);
    assert_int_equal(w.count, count);
    dem_free(&w);
}

/* Shares of a source of spheres, compounds and polyhedra are exact to one body, in a region with too little room, too;
   a save and a copy of the feeds go on with the same bodies for any number of threads. */
static void test_shares(void **state) {
    (void)state;
    dem_world w, again;
    start(&w, definition(2e-5, 200.0, 0.3, 0.5, dem_vec3(0, 0, -9.81)));
    const dem_compound c = make(&w, ell, 2), h = make(&w, hook, 3);
    dem_feed feed[4] = {feed_of(&c), feed_of(&h), feed_of(NULL), feed_of(NULL)};
    const double share[4] = {0.4, 0.3, 0.2, 0.1};
    dem_source source;
    memset(&source, 0, sizeof source);
    feed[2].sizes = dem_uniform_sizes(2e-3, 4e-3, 1);
    feed[3].polyhedron = 1 + h.shape[0];
    for (int k = 0; k < 4; k++) feed[k].region = dem_box_region(none, dem_vec3(0.1, 0.1, 0.04)), feed[k].tries = 50;
    source.feed = feed, source.share = share, source.classes = 4;
    for (int n = 0; n < 10; n++) {
        assert_int_equal(dem_feed_source_mass(&w, &source, 4.0, 1e-3), DEM_OK);
        double sum = 0.0, in_world = 0.0;
        for (int k = 0; k < 4; k++) sum += feed[k].placed_mass;
        for (ptrdiff_t i = 0; i < w.count; i++) in_world += dem_mass(&w, i) / (double)dem_get_body(&w, i).pieces;
        close_to(in_world, sum, 1e-12);
        for (int k = 0; k < 4; k++) assert_true(fabs(feed[k].placed_mass - share[k] * sum) < 1000.0 * h.volume);
        run(&w, 1e-3, 0);
    }
    assert_true(source.due_mass > 1000.0 * h.volume); /* it waits for room */
    assert_true(feed[0].placed > 3 && feed[1].placed > 3 && feed[2].placed > 3 && feed[3].placed > 3);
    const size_t size = dem_save(&w, NULL, 0);
    unsigned char *bytes = (unsigned char *)malloc(size);
    assert_int_equal(dem_save(&w, bytes, size), size);
    assert_int_equal(dem_load(&again, bytes, size, NULL), DEM_OK);
    free(bytes);
    dem_feed copy[4];
    memcpy(copy, feed, sizeof copy);
    dem_source other = source;
    other.feed = copy;
    again.def.threads = 3;
    for (int n = 0; n < 5; n++) {
        for (int k = 0; k < 4; k++) feed[k].region.high.z = copy[k].region.high.z = 0.04 + 0.01 * n;
        assert_int_equal(dem_feed_source_mass(&w, &source, 4.0, 1e-3), DEM_OK);
        assert_int_equal(dem_feed_source_mass(&again, &other, 4.0, 1e-3), DEM_OK);
        run(&w, 1e-3, 0), run(&again, 1e-3, 0);
    }
    assert_true(feed[0].placed == copy[0].placed && dem_hash(&w) == dem_hash(&again));
    dem_free(&w), dem_free(&again);
}

/* Memory that runs out at any place leaves a world that can be run and freed; a part of a save that lies is refused. */
static dem_status all_at(failing_allocator *memory) {
    dem_def def = definition(4e-6, 4000.0, 0.5, 0.5, down);
    dem_world w;
    dem_convex part[2];
    dem_compound c;
    const double at[6] = {0, 0, 4e-3, 0.004, 0, 0.011};
    def.allocator.fn = failing_fn, def.allocator.user = memory;
    dem_status s = dem_init(&w, &def, NULL);
    if (s != DEM_OK) return s;
    if (dem_add_plane(&w, 0, none, dem_vec3(0, 0, 1)) < 0) s = DEM_OUT_OF_MEMORY;
    for (int k = 0; k < 2; k++) make_box(&part[k], &ell[k]);
    if (s == DEM_OK) s = dem_make_compound(&w, 2, part, NULL, NULL, &c, NULL);
    if (s == DEM_OK) s = dem_add_compounds(&w, 2, &c, at, NULL, 0, 0);
    if (s == DEM_OK) s = dem_run(&w, 0.02, LINEAR);
    dem_feed feed = feed_of(&c);
    if (s == DEM_OK) s = dem_fill(&w, &feed, 3);
    if (s == DEM_OK) assert_int_equal(w.count, 10);
    dem_free(&w);
    return s;
}
static void test_memory(void **state) {
    (void)state;
    for (int k = 0, more = 1; more; k++) {
        failing_allocator memory;
        failing_init_at(&memory, k);
        const dem_status s = all_at(&memory);
        more = memory.has_failed;
        assert_int_equal(s, more ? DEM_OUT_OF_MEMORY : DEM_OK);
        assert_int_equal(failing_live(&memory), 0);
        assert_int_equal(memory.misused, 0);
    }
}
static void test_lying_save(void **state) {
    (void)state;
    dem_world w, again;
    start(&w, definition(4e-6, 4000.0, 0.5, 0.5, down));
    const dem_compound c = make(&w, ell, 2);
    put(&w, &c, none, NULL);
    for (int n = 0; n < 4; n++) {
        const dem_quaternion kept = w.engine->convex.part[1];
        if (n == 1) w.engine->convex.part[1] = dem__quaternion(0.0, none);
        if (n == 2) w.engine->convex.part[1].x += 0.5;
        if (n == 3) w.engine->convex.shape_of[1] = 0;
        const size_t size = dem_save(&w, NULL, 0);
        unsigned char *bytes = (unsigned char *)malloc(size);
        assert_int_equal(dem_save(&w, bytes, size), size);
        assert_int_equal(dem_load(&again, bytes, size, NULL), n ? DEM_BAD_DATA : DEM_OK);
        if (n == 0) dem_free(&again);
        free(bytes);
        w.engine->convex.part[1] = kept;
    }
    dem_free(&w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mass),          cmocka_unit_test(test_refusals), cmocka_unit_test(test_one_part),
        cmocka_unit_test(test_flat_landing),  cmocka_unit_test(test_tumble),   cmocka_unit_test(test_hits),
        cmocka_unit_test(test_rest),          cmocka_unit_test(test_hooks),    cmocka_unit_test(test_bits),
        cmocka_unit_test(test_counts_as_one), cmocka_unit_test(test_memory),   cmocka_unit_test(test_lying_save),
        cmocka_unit_test(test_feed),          cmocka_unit_test(test_shares),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
