/* test_dem_bodies.c: orientation and rotation of rigid bodies in dem.h, against closed forms and the 17-digit
   references of the Euler top (Jacobi elliptic functions and quaternions, computed with 40 digits). */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "dem.h"

static const dem_quaternion ONE = {1.0, 0.0, 0.0, 0.0};

/* A world without gravity and, unless 0, a body of given moments with one particle of 1 mm. */
static void make_world(dem_world *w, double dt, int periodic) {
    dem_def def = dem_default_def();
    dem_add_material(&def, 2500.0, 1e7, 0.3);
    def.dt = dt, def.gravity = dem_vec3(0, 0, 0);
    def.periodic[0] = periodic;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
}
static ptrdiff_t add_top(dem_world *w, dem_vec x, double mass, dem_vec moments) {
    dem__body_def def;
    const dem_vec centre = dem_vec3(0, 0, 0);
    const double radius = 0.1;
    memset(&def, 0, sizeof def);
    def.x = x, def.mass = mass, def.moments = moments, def.frame = def.turn = ONE;
    def.pieces = 1, def.offset = &centre, def.radius = &radius;
    assert_true(dem__reserve_bodies(w, 1, 1));
    return dem__add_body(w, &def);
}

static double quaternion_error(dem_quaternion a, const double *b) {
    const double same = fabs(a.w - b[0]) + fabs(a.x - b[1]) + fabs(a.y - b[2]) + fabs(a.z - b[3]);
    const double opposite = fabs(a.w + b[0]) + fabs(a.x + b[1]) + fabs(a.y + b[2]) + fabs(a.z + b[3]);
    return same < opposite ? same : opposite;
}
static double length_of(dem_quaternion q) { return sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z); }

/* I = (1, 2, 3), w0 = (1, 0, 1): w = (cn t, sn t, dn t) with m = 1/3. */
static const double TOP_AT[3][5] = {
    {1, .77903960258822208, .35820926595727759, .1958299706947999, .4758508610470377},
    {5, -.89205938023754275, .34571995700736429, -.24610292441078016, .15537414216496626},
    {10, .86144117406547744, .10734075762015901, .22094732179436732, -.44449898354227806}};

static void test_euler_top_flies_to_the_reference(void **state) {
    (void)state;
    dem_world w;
    make_world(&w, 1e-3, 0);
    const ptrdiff_t i = add_top(&w, dem_vec3(0, 0, 0), 1.0, dem_vec3(1, 2, 3));
    assert_int_equal(dem_set_motion(&w, i, dem_vec3(0, 0, 0), dem_vec3(1, 0, 1)), DEM_OK);
    for (int k = 0; k < 3; k++) {
        assert_int_equal(dem_run(&w, TOP_AT[k][0] - w.time, DEM_LINEAR), DEM_OK);
        assert_true(quaternion_error(dem_orientation(&w, i), TOP_AT[k] + 1) < 1e-9);
        assert_true(fabs(length_of(dem_orientation(&w, i)) - 1.0) < 1e-14);
    }
    const dem_body body = dem_get_body(&w, i);
    const dem_vec spin = dem__to_body(body.orientation, body.spin);
    assert_true(fabs(spin.x + .921069998444332243) + fabs(spin.y - .38939704411533198) +
                    fabs(spin.z - .974400660583082425) <
                1e-9);
    assert_int_equal(w.engine->bodies.active_count, 0); /* in flight: it takes no steps */
    dem_free(&w);
}

/* Order of a drift, by errors at t = 10 with steps of h and h/2. */
static double drift_error(double h, int far) {
    const dem_vec moments = dem_vec3(1, 2, 3), momentum = dem_vec3(1, 0, 3);
    dem_quaternion q = ONE;
    const int n = (int)(10.0 / h + 0.5);
    for (int k = 0; k < n; k++)
        q = far ? dem__turn_far(q, momentum, moments, h) : dem__turn_split(q, momentum, moments, h);
    return quaternion_error(q, TOP_AT[2] + 1);
}
static void test_drift_of_three_moments_has_its_order(void **state) {
    (void)state;
    const double ratio = drift_error(0.1, 0) / drift_error(0.05, 0);
    print_message("    splitting, h = 0.1: %.2e, order %.2f\n", drift_error(0.1, 0),
                  riddle_log(ratio) / riddle_log(2.0));
    assert_true(ratio > 3.8 && ratio < 4.2);
    assert_true(drift_error(0.1, 0) < 5e-3);
    print_message("    sixth order, h = 10, 0.025, 0.0125: %.2e %.2e %.2e\n", drift_error(10.0, 1),
                  drift_error(0.025, 1), drift_error(0.0125, 1));
    assert_true(drift_error(10.0, 1) < 1e-9);
    assert_true(drift_error(0.0125, 1) < 1e-13);
}

/* A brick 1 : 1 : 2.08 turns exactly, in flight and in one stroke. */
static void test_brick_top(void **state) {
    (void)state;
    static const double at_3[4] = {-.34983651, .1197886, -.73801626, -.56444407};
    const double a = 0.443866666666667, c = 1.0 / 6.0;
    dem_world w;
    make_world(&w, 1e-3, 0);
    const ptrdiff_t i = add_top(&w, dem_vec3(0, 0, 0), 1.0, dem_vec3(a, a, c));
    assert_int_equal(dem_set_motion(&w, i, dem_vec3(0, 0, 0), dem_vec3(1, .5, 2)), DEM_OK);
    assert_int_equal(dem_run(&w, 3.0, DEM_LINEAR), DEM_OK);
    assert_true(quaternion_error(dem_orientation(&w, i), at_3) < 2e-8);
    const dem_vec spin = dem__to_body(dem_orientation(&w, i), dem_spin(&w, i));
    assert_true(fabs(spin.x + 1.10680763) + fabs(spin.y - .1580407) + fabs(spin.z - 2.0) < 3e-8);
    const dem_vec momentum = dem_vec3(a, .5 * a, 2.0 * c);
    dem_quaternion q = ONE, once = dem__turn_free(ONE, momentum, dem_vec3(a, a, c), 3.0, 1);
    for (int k = 0; k < 300; k++) q = dem__turn_free(q, momentum, dem_vec3(a, a, c), 0.01, 1);
    const double many[4] = {q.w, q.x, q.y, q.z};
    assert_true(quaternion_error(once, many) < 5e-14);
    dem_free(&w);
}

/* A top that has turned by millions of radians in one flight is where it should be. */
static void test_top_turns_for_long(void **state) {
    (void)state;
    const double spin = 2e4, time = 200.0, half = 0.5 * spin * time, at_end[4] = {cos(half), 0, 0, sin(half)};
    for (int k = 0; k < 2; k++) {
        dem_world w;
        make_world(&w, 1e-3, 0);
        const ptrdiff_t i = add_top(&w, dem_vec3(0, 0, 0), 1.0, k ? dem_vec3(1, 1, 1) : dem_vec3(0.5, 0.5, 0.2));
        assert_int_equal(dem_set_motion(&w, i, dem_vec3(0, 0, 0), dem_vec3(0, 0, spin)), DEM_OK);
        assert_int_equal(dem_run(&w, time, DEM_LINEAR), DEM_OK);
        assert_true(quaternion_error(dem_orientation(&w, i), at_end) < 1e-8);
        assert_int_equal(w.engine->bodies.active_count, 0);
        dem_free(&w);
    }
}

/* The frame of moments given in another order is told apart: the same body, its axes exchanged. */
static void test_axes_in_any_order(void **state) {
    (void)state;
    const double m[3] = {1, 2, 3.1}, s[3] = {1, .2, .7};
    dem_vec spin[3], e[3];
    for (int k = 0; k < 3; k++) { /* the lab's axes exchanged with the body's */
        dem_world w;
        make_world(&w, 1e-3, 0);
        const ptrdiff_t i = add_top(&w, dem_vec3(0, 0, 0), 1.0, dem_vec3(m[k], m[(k + 1) % 3], m[(k + 2) % 3]));
        dem_set_motion(&w, i, dem_vec3(0, 0, 0), dem_vec3(s[k], s[(k + 1) % 3], s[(k + 2) % 3]));
        assert_int_equal(dem_run(&w, 2.0, DEM_LINEAR), DEM_OK);
        /* axis 0 of m */
        const dem_vec v = dem_spin(&w, i), x = dem__to_lab(dem_orientation(&w, i), dem_vec3(k == 0, k == 2, k == 1));
        const double of[3] = {v.x, v.y, v.z}, at[3] = {x.x, x.y, x.z};
        spin[k] = dem_vec3(of[(3 - k) % 3], of[(4 - k) % 3], of[(5 - k) % 3]);
        e[k] = dem_vec3(at[(3 - k) % 3], at[(4 - k) % 3], at[(5 - k) % 3]);
        assert_true(dem__length(dem__sub(spin[k], spin[0])) < 1e-13);
        assert_true(dem__length(dem__sub(e[k], e[0])) < 1e-13);
        dem_free(&w);
    }
}

/* A top under the torque of a field, U = R axis . g: kick, drift, kick. Relative drift of its energy over 800, by the
   line that fits best. off: of the first spin. */
static double torqued_drift(dem_vec moments, double off) {
    const dem_vec g = dem_vec3(0.3, -0.2, 0.5), axis = dem_vec3(0.2, 0.1, 1.0);
    dem_quaternion q = ONE;
    dem_vec l = dem__momentum_of(q, moments, dem_vec3(1 + off, 0.3, 1));
    const double h = 0.1;
    double sum = 0.0, slope = 0.0;
    const int n = 8000;
    for (int k = 0; k < n; k++) {
        const dem_vec e = dem__to_lab(q, axis);
        const double energy = 0.5 * dem__dot(l, dem__spin_of(q, moments, l)) + dem__dot(e, g);
        sum += energy, slope += (k - 0.5 * (n - 1)) * energy;
        l = dem__plus(l, -0.5 * h, dem__cross(e, g));
        q = dem__kept_unit(dem__turn_free(q, l, moments, h, 1));
        l = dem__plus(l, -0.5 * h, dem__cross(dem__to_lab(q, axis), g));
    }
    assert_true(fabs(length_of(q) - 1.0) < 1e-14);
    return 12.0 * slope / ((double)n * n * n) * n / (sum / n);
}
/* With three moments the motion is chaotic: rounding decides the slope of one run, +-1e-5. So the mean of
   many is tested. */
static void test_energy_of_a_torqued_top_does_not_drift(void **state) {
    (void)state;
    double split = 0.0, exact = torqued_drift(dem_vec3(2, 2, 3), 0.0);
    for (int k = 0; k < 40; k++) split += torqued_drift(dem_vec3(1, 2, 3), 1e-12 * k) / 40;
    print_message("    energy drift over 800: %.1e (three moments), %.1e (two equal)\n", split, exact);
    assert_true(fabs(split) < 1e-5 && fabs(exact) < 1e-5);
}

/* In a world under a constant load: steps of dem_run, energy by the ledger, momentum kept by the drift. */
static void test_loaded_top_closes_the_ledger(void **state) {
    (void)state;
    double error[2];
    for (int k = 0; k < 2; k++) {
        dem_world w;
        make_world(&w, k ? 5e-4 : 1e-3, 0);
        const ptrdiff_t i = add_top(&w, dem_vec3(0, 0, 0), 1.0, dem_vec3(1, 2, 3));
        dem_set_motion(&w, i, dem_vec3(0.1, 0, 0), dem_vec3(1, 0.5, -1));
        assert_int_equal(dem_set_load(&w, i, dem_vec3(0.1, 0, 0), dem_vec3(0.05, -0.1, 0.2)), DEM_OK);
        assert_int_equal(dem_run(&w, 5.0, DEM_LINEAR | DEM_ENERGY), DEM_OK);
        const dem_body b = dem_get_body(&w, i);
        const dem_vec l = dem__momentum_of(b.axes, b.moments, b.spin);

        /* (1, 1, -3) + 5 (0.05, -0.1, 0.2) */
        assert_true(fabs(l.x - 1.25) + fabs(l.y - 0.5) + fabs(l.z + 2.0) < 1e-11);
        assert_true(fabs(b.velocity.x - 0.6) < 1e-12);
        error[k] = fabs(dem_energy(&w).error);
        dem_free(&w);
    }
    assert_true(error[0] < 1e-6 && error[1] < 0.3 * error[0]);
}

/* Saved in flight and under a load, a top goes on with the same bits. */
static void test_saved_and_loaded(void **state) {
    (void)state;
    for (int loads = 0; loads < 2; loads++) {
        dem_world w, v;
        make_world(&w, 1e-3, 1);
        const double centre[3] = {0.2, 0, 0.1}, diameter = 1e-2;
        dem_add_spheres(&w, 1, centre, &diameter, 0, 0);
        const ptrdiff_t gone = add_top(&w, dem_vec3(.3, .3, .3), 2.0, dem_vec3(2, 2, 3));
        const ptrdiff_t i = add_top(&w, dem_vec3(.9, 0, 0), 1.0, dem_vec3(3, 1, 2));
        const double centre2[3] = {0.2, 0.3, 0.1};
        dem_add_spheres(&w, 1, centre2, &diameter, 0, 0);
        dem_set_motion(&w, i, dem_vec3(0.05, 0, 0), dem_vec3(1, 0.5, -1));
        if (loads) dem_set_load(&w, i, dem_vec3(0, 0, 0.01), dem_vec3(0.05, -0.1, 0.2));
        assert_int_equal(dem_remove(&w, gone), DEM_OK);
        assert_int_equal(dem_run(&w, 0.7, DEM_LINEAR), DEM_OK);
        unsigned char buffer[1 << 16];
        const size_t size = dem_save(&w, buffer, sizeof buffer);
        assert_true(size > 0 && size < sizeof buffer);
        assert_int_equal(dem_load(&v, buffer, size, NULL), DEM_OK);
        assert_true(dem_hash(&w) == dem_hash(&v));
        assert_int_equal(dem_run(&w, 0.8, DEM_LINEAR), DEM_OK);
        assert_int_equal(dem_run(&v, 0.8, DEM_LINEAR), DEM_OK);
        assert_true(dem_hash(&w) == dem_hash(&v));
        const ptrdiff_t k = v.count - 2;
        assert_true(dem_get_body(&v, k).pieces == 1 && dem_get_body(&v, k).moments.x > 0.0);
        assert_true(dem__length(dem__sub(dem_spin(&v, k), dem_spin(&w, w.count - 2))) == 0.0);
        for (size_t cut = 0; cut < size; cut += 97) { /* a torn save is refused */
            dem_world torn;
            assert_int_equal(dem_load(&torn, buffer, cut, NULL), DEM_BAD_DATA);
        }
        dem_free(&w), dem_free(&v);
    }
}

static void test_bad_arguments(void **state) {
    (void)state;
    const dem_quaternion none = {0, 0, 0, 0}, nan = {1, (double)NAN, 0, 0}, wide = {1e300, 1e300, 0, 0},
                         inf = {1, (double)INFINITY, 0, 0}, tiny = {0, 0, 1e-310, 0};
    dem_world w;
    make_world(&w, 1e-3, 0);
    const double centre[3] = {0, 0, 0}, diameter = 1e-3;
    dem_add_spheres(&w, 1, centre, &diameter, 0, 0);
    const ptrdiff_t i = add_top(&w, dem_vec3(1, 0, 0), 1.0, dem_vec3(1, 2, 3));
    assert_int_equal(dem_set_orientation(&w, 0, ONE), DEM_BAD_ARGUMENT); /* a sphere has none */
    assert_int_equal(dem_set_orientation(&w, 2, ONE), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_orientation(&w, -1, ONE), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_orientation(NULL, 0, ONE), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_orientation(&w, i, none), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_orientation(&w, i, nan), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_orientation(&w, i, inf), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_orientation(&w, i, wide), DEM_OK);
    assert_true(fabs(dem_orientation(&w, i).w - sqrt(0.5)) < 1e-15);
    assert_int_equal(dem_set_orientation(&w, i, tiny), DEM_OK);
    assert_true(fabs(fabs(dem_orientation(&w, i).y) - 1.0) < 1e-15);
    assert_true(isnan(dem_orientation(&w, 7).w) && isnan(dem_orientation(NULL, 0).w) && isnan(dem_spin(&w, -1).x));
    assert_true(dem_orientation(&w, 0).w == 1.0);
    assert_true(dem_get_body(&w, 9).first == -1 && dem_get_body(NULL, 0).first == -1);
    assert_true(dem_get_body(&w, 0).pieces == 1 && dem_get_body(&w, 0).diameter == 1e-3);
    assert_int_equal(dem_set_motion(&w, i, dem_vec3(0, 0, 0), dem_vec3((double)NAN, 0, 0)), DEM_BAD_ARGUMENT);
    dem_free(&w);
}

/* ---- shapes ---- */

static double between(uint64_t *r, double low, double high) { return low + (high - low) * dem__uniform(r); }

/* Numbers are drawn one after the other: compilers differ in the order of a call's arguments. */
static dem_vec vector_between(uint64_t *r, double low, double high) {
    dem_vec v;
    v.x = between(r, low, high);
    v.y = between(r, low, high);
    v.z = between(r, low, high);
    return v;
}

static void test_shapes_have_their_mass_properties(void **state) {
    (void)state;
    dem_clump c;
    const double two[6] = {0, 0, 0, 0.3, 0, 0}, apart[2] = {0.2, 0.2}, lens[2] = {0.4, 0.4}, one[2] = {0.4, 0.1};
    /* apart: sums, and Steiner's rule */
    assert_int_equal(dem_make_clump(2, two, apart, &c), DEM_OK);
    const double v = RIDDLE_PI / 6.0 * 0.008, own = 0.4 * v * 0.01, far = v * 0.0225;
    assert_true(fabs(c.volume / (2.0 * v) - 1.0) < 1e-14 && fabs(c.origin.x - 0.15) < 1e-15);
    assert_true(c.moments.x == c.moments.y && fabs(c.moments.x / (2.0 * (own + far)) - 1.0) < 1e-13);
    assert_true(fabs(c.moments.z / (2.0 * own) - 1.0) < 1e-13 &&
                fabs(dem__to_lab(c.axes, dem_vec3(0, 0, 1)).x) > 1.0 - 1e-15);
    /* overlapping by a lens of two caps of height h */
    assert_int_equal(dem_make_clump(2, two, lens, &c), DEM_OK);
    const double r = 0.2, h = 0.05, cap = RIDDLE_PI * h * h * (3.0 * r - h) / 3.0;
    assert_true(fabs(c.volume / (8.0 / 3.0 * RIDDLE_PI * r * r * r - 2.0 * cap) - 1.0) < 1e-13);
    /* one in another */
    assert_int_equal(dem_make_clump(2, two, one, &c), DEM_OK);
    assert_true(c.spheres == 2);
    const double inner[6] = {0, 0, 0, 0.1, 0, 0};
    assert_int_equal(dem_make_clump(2, inner, one, &c), DEM_OK);
    assert_true(c.spheres == 1 && fabs(dem_clump_diameter(&c) / 0.4 - 1.0) < 1e-15);
    /* the same shape nearly on a line: the surface has what the body of revolution has */
    const double three[9] = {0, 0, 0, 0.1, 0.02, 0.05, 0.2, 0.04, 0.1}, sizes[3] = {0.2, 0.25, 0.15};
    dem_clump exact;
    assert_int_equal(dem_make_clump(3, three, sizes, &exact), DEM_OK);
    double bent[9];
    for (int k = 0; k < 9; k++) bent[k] = three[k];
    bent[4] += 1e-11;
    assert_int_equal(dem_make_clump(3, bent, sizes, &c), DEM_OK);
    print_message("    off the line: volume %.1e, moments %.1e %.1e\n", c.volume / exact.volume - 1.0,
                  c.moments.x / exact.moments.x - 1.0, c.moments.z / exact.moments.z - 1.0);
    assert_true(fabs(c.volume / exact.volume - 1.0) < 1e-10 && c.moments.x == c.moments.y);
    assert_true(fabs(c.moments.x / exact.moments.x - 1.0) < 1e-10 && fabs(c.moments.z / exact.moments.z - 1.0) < 1e-10);
    /* three of a right angle, apart: the tensor about the principal axes is the one that was put in */
    const double angle[9] = {10, 5, 1, 11, 5, 1, 10, 7, 1}, small[3] = {0.5, 0.5, 0.5};
    assert_int_equal(dem_make_clump(3, angle, small, &c), DEM_OK);
    const double m = RIDDLE_PI / 6.0 * 0.125, x[3] = {-1.0 / 3.0, 2.0 / 3.0, -1.0 / 3.0},
                 y[3] = {-2.0 / 3.0, -2.0 / 3.0, 4.0 / 3.0};
    double xx = 0.0, xy = 0.0;
    for (int k = 0; k < 3; k++) xx += m * (y[k] * y[k] + 0.025), xy -= m * x[k] * y[k];
    const dem_vec e = dem_vec3(1, 0, 0), column = dem__momentum_of(c.axes, c.moments, e);
    assert_true(fabs(column.x / xx - 1.0) < 1e-13 && fabs(column.y / xy - 1.0) < 1e-13 && fabs(column.z) < 1e-15);
    /* four of a tetrahedron, overlapping: a spherical tensor */
    const double tetra[12] = {1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1}, fat[4] = {3, 3, 3, 3};
    assert_int_equal(dem_make_clump(4, tetra, fat, &c), DEM_OK);
    assert_true(c.moments.x == c.moments.y && c.moments.y == c.moments.z);
}

/* Sums of moments do not depend on axes. */
static double trace_of(const dem_clump *c) { return c->moments.x + c->moments.y + c->moments.z; }

/* Makes the clump as it is and turned: the same volume and moments within a tolerance. */
static dem_clump turned_alike(uint64_t *r, int n, const double *centre, const double *d, double tolerance) {
    dem_clump c, other;
    dem_quaternion q;
    double turned[3 * DEM_CLUMP_MAX];
    const dem_vec v = vector_between(r, -1.0, 1.0);
    assert_int_equal(dem_make_clump(n, centre, d, &c), DEM_OK);
    assert_true(dem__unit_turn(dem__quaternion(0.7, v), &q));
    for (int k = 0; k < n; k++) {
        const dem_vec at = dem__to_lab(q, dem_vec3(centre[3 * k], centre[3 * k + 1], centre[3 * k + 2]));
        turned[3 * k] = at.x + 3.0, turned[3 * k + 1] = at.y, turned[3 * k + 2] = at.z - 7.0;
    }
    assert_int_equal(dem_make_clump(n, turned, d, &other), DEM_OK);
    if (!(fabs(c.volume / other.volume - 1.0) < tolerance && fabs(trace_of(&c) / trace_of(&other) - 1.0) < tolerance))
        fail_msg("%d spheres: %.17g %.17g, turned %.17g %.17g", n, c.volume, trace_of(&c), other.volume,
                 trace_of(&other));
    return c;
}

/* Overlapping spheres anywhere: pairs far apart, a bent fibre, lattices on which many rims meet in a point,
   specks, near twins. */
static void test_unions_of_spheres(void **state) {
    (void)state;
    uint64_t r = 11;
    double x[3 * DEM_CLUMP_MAX], d[DEM_CLUMP_MAX];
    dem_clump c, two[2];
    for (double far = 10.0; far < 2e5; far *= 10.0) { /* two pairs, which are known, with Steiner's rule */
        const double at[12] = {0, 0, 0, 1.2, 0.1, 0, far, 0, 0.3, far + 1.2, 0.1, 0.5}, all[4] = {2, 2, 2, 2};
        c = turned_alike(&r, 4, at, all, 1e-11);
        double trace = 0.0, volume = 0.0;
        for (int k = 0; k < 2; k++) {
            assert_int_equal(dem_make_clump(2, at + 6 * k, all, &two[k]), DEM_OK);
            volume += two[k].volume, trace += trace_of(&two[k]);
        }
        const dem_vec apart = dem__sub(two[0].origin, two[1].origin);
        trace += 2.0 * two[0].volume * two[1].volume / volume * dem__dot(apart, apart);
        assert_true(fabs(c.volume / volume - 1.0) < 1e-11 && fabs(trace_of(&c) / trace - 1.0) < 1e-11);
    }
    for (int k = 0; k < DEM_CLUMP_MAX; k++) {
        x[3 * k] = 0.5 * k, x[3 * k + 1] = 0.0008 * k * k, x[3 * k + 2] = between(&r, -0.3, 0.3);
        d[k] = 1.0;
    }
    turned_alike(&r, DEM_CLUMP_MAX, x, d, 1e-12);
    /* a lattice of 4 x 4 x 4 whose spheres overlap in pairs only: less 144 lenses */
    for (int k = 0; k < DEM_CLUMP_MAX; k++)
        x[3 * k] = k % 4, x[3 * k + 1] = k / 4 % 4, x[3 * k + 2] = k / 16, d[k] = 1.2;
    c = turned_alike(&r, DEM_CLUMP_MAX, x, d, 1e-12);
    const double cap = RIDDLE_PI * 0.01 * (1.8 - 0.1) / 3.0;
    assert_true(fabs(c.volume / (64.0 * RIDDLE_PI / 6.0 * 1.728 - 288.0 * cap) - 1.0) < 1e-13);
    /* No hole is left in the middle of a cell: its diagonal is 1.73. */
    for (int k = 0; k < DEM_CLUMP_MAX; k++) d[k] = 1.8;
    c = turned_alike(&r, DEM_CLUMP_MAX, x, d, 1e-12);
    assert_true(c.volume > 27.0 && c.moments.x == c.moments.y && c.moments.y == c.moments.z);
    const double square[12] = {1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 0}, sizes[3] = {sqrt(2.0), 2.0, sqrt(8.0)};
    for (int k = 0; k < 3; k++) { /* touching; all through the centre; all through two points */
        const double all[4] = {sizes[k], sizes[k], sizes[k], sizes[k]};
        turned_alike(&r, 4, square, all, 1e-12);
    }
    const double speck[9] = {0, 0, 0, 1, 0, 0, 0, 1.0005, 0}, of_specks[3] = {2, 2e-3, 2e-3};
    turned_alike(&r, 3, speck, of_specks, 1e-12);
    for (double off = 1e-3; off > 1e-15; off *= 0.01) {
        const double twins[9] = {0, 0, 0, off, 0, 0, 0, off, 0}, same[3] = {1, 1, 1};
        c = turned_alike(&r, 3, twins, same, 1e-11);
        assert_true(c.volume >= RIDDLE_PI / 6.0 * (1.0 - 1e-12) &&
                    c.volume < RIDDLE_PI / 6.0 * (1.0 + 4.0 * off + 1e-12));
    }
    for (int trial = 0; trial < 60; trial++) { /* places and sizes in halves: what meets, meets exactly */
        const int n = 3 + trial / 2;
        for (int k = 0; k < 3 * n; k++) x[k] = 0.5 * floor(between(&r, 0.0, 4.0));
        for (int k = 0; k < n; k++) d[k] = 0.5 + 0.5 * (double)(k % 3);
        turned_alike(&r, n, x, d, 1e-8);
    }
}

static void test_shapes_are_checked(void **state) {
    (void)state;
    static double many[3 * (DEM_CLUMP_MAX + 1)], sizes[DEM_CLUMP_MAX + 1];
    dem_clump c;
    const double at[6] = {0, 0, 0, 1, 0, 0}, bad[6] = {0, 0, 0, (double)NAN, 0, 0},
                 far[6] = {0, 0, 0, (double)INFINITY, 0, 0};
    const double d[2] = {1, 1}, none[2] = {1, 0}, nan[2] = {1, (double)NAN}, tiny[2] = {1e-300, 1e-300};
    for (int k = 0; k <= DEM_CLUMP_MAX; k++) many[3 * k] = k, sizes[k] = 1.0;
    assert_int_equal(dem_make_clump(DEM_CLUMP_MAX, many, sizes, &c), DEM_OK);
    assert_int_equal(dem_make_clump(DEM_CLUMP_MAX + 1, many, sizes, &c), DEM_TOO_MANY);
    assert_int_equal(dem_make_clump(0, at, d, &c), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_clump(2, NULL, d, &c), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_clump(2, at, NULL, &c), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_clump(2, at, d, NULL), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_clump(2, bad, d, &c), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_clump(2, far, d, &c), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_clump(2, at, none, &c), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_clump(2, at, nan, &c), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_clump(2, at, tiny, &c), DEM_BAD_ARGUMENT);
    assert_true(isnan(dem_clump_diameter(NULL)));
    dem_world w;
    make_world(&w, 1e-6, 0);
    const double centre[3] = {0, 0, 0}, wrong[3] = {0, (double)NAN, 0}, turn[4] = {1, 0, 0, 0},
                 no_turn[4] = {0, 0, 0, 0}, zero = 0.0;
    assert_int_equal(dem_make_clump(2, at, d, &c), DEM_OK);
    assert_int_equal(dem_add_clumps(&w, 1, &c, centre, NULL, turn, 0, 0), DEM_OK);
    assert_int_equal(dem_add_clumps(&w, 0, &c, NULL, NULL, NULL, 0, 0), DEM_OK);
    assert_int_equal(dem_add_clumps(NULL, 1, &c, centre, NULL, NULL, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_clumps(&w, 1, NULL, centre, NULL, NULL, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_clumps(&w, 1, &c, NULL, NULL, NULL, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_clumps(&w, 1, &c, wrong, NULL, NULL, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_clumps(&w, 1, &c, centre, &zero, NULL, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_clumps(&w, 1, &c, centre, NULL, no_turn, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_clumps(&w, 1, &c, centre, NULL, NULL, 1, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_clumps(&w, -1, &c, centre, NULL, NULL, 0, 0), DEM_BAD_ARGUMENT);
    dem_clump spoilt = c;
    spoilt.moments.x = 3.0 * (c.moments.y + c.moments.z);
    assert_int_equal(dem_add_clumps(&w, 1, &spoilt, centre, NULL, NULL, 0, 0), DEM_BAD_ARGUMENT);
    spoilt = c, spoilt.volume = (double)NAN;
    assert_int_equal(dem_add_clumps(&w, 1, &spoilt, centre, NULL, NULL, 0, 0), DEM_BAD_ARGUMENT);
    assert_true(w.count == 2 && w.engine->bodies.rigid_count == 1);
    dem_free(&w);
}

/* ---- clumps that touch ---- */

static dem_def hit_def(double dt, double restitution, dem_restitution mode, double stiffness) {
    dem_def def = dem_default_def();
    dem_add_material(&def, 2500.0, 1e7, 0.3);
    dem_pair_def *p = dem_pair(&def, 0, 0);
    p->restitution = restitution, p->mode = mode, p->stiffness = stiffness;
    def.dt = dt, def.gravity = dem_vec3(0, 0, 0);
    return def;
}

/* A sphere, a clump of one and a clump of two coincident halves fly, roll and bounce alike. */
static void test_clump_of_one_is_a_sphere(void **state) {
    (void)state;
    const double centre[3] = {0, 0, 0.006}, d = 0.01, halves[6] = {1, 2, 3, 1, 2, 3}, both[2] = {0.01, 0.01},
                 other[3] = {0.02, 0, 0.006};
    dem_vec x[3], v[3], s[3];
    for (int hertz = 0; hertz < 2; hertz++) {
        for (int k = 0; k < 3; k++) {
            dem_def def = hit_def(2e-6, 0.6, DEM_CLIPPED, 1e5);
            def.gravity = dem_vec3(0, 0, -9.81);
            dem_pair(&def, 0, 0)->rolling = 1e-5;
            dem_world w;
            dem_clump c;
            assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
            dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
            if (k > 0) {
                const double turn[4] = {0.3, 0.5, -0.2, 0.7};
                assert_int_equal(dem_make_clump(k, halves, both, &c), DEM_OK);
                assert_int_equal(dem_add_clumps(&w, 1, &c, centre, NULL, turn, 0, 0), DEM_OK);
            } else dem_add_spheres(&w, 1, centre, &d, 0, 0);
            dem_add_spheres(&w, 1, other, &d, 0, 0);
            dem_set_motion(&w, 0, dem_vec3(0.5, 0.01, -0.3), dem_vec3(3, -20, 5));
            assert_int_equal(dem_run(&w, 0.1, (hertz ? DEM_HERTZ : DEM_LINEAR) | DEM_FRICTION | DEM_ROLLING), DEM_OK);
            assert_true(w.count == 2);
            x[k] = dem_position(&w, 0), v[k] = dem_velocity(&w, 0), s[k] = dem_spin(&w, 0);
            dem_free(&w);
        }
        for (int k = 1; k < 3; k++) {
            assert_true(dem__length(dem__sub(x[k], x[0])) < 1e-12 * dem__length(x[0]));
            assert_true(dem__length(dem__sub(v[k], v[0])) < 1e-12 * 0.5);
            assert_true(dem__length(dem__sub(s[k], s[0])) < 1e-11 * 100.0);
        }
    }
}

/* A clump of two spheres, tilted, hits a plane with one: impulse (1 + e) m v with 1/m = 1/M + (r x n)^2/I, and the
   dashpot that was made for M acts on m. */
static void dimer_hit(double stiffness, double restitution, double *error) {
    const double at[6] = {0, 0, 0, 0, 0, 0.012}, d[2] = {0.01, 0.01}, tilt = 0.35, speed = 0.4;
    const double turn[4] = {riddle_cos(0.5 * tilt), riddle_sin(0.5 * tilt), 0, 0}, centre[3] = {0, 0, 0.0115};
    dem_def def =
        hit_def(0.02 * sqrt(2.0 * RIDDLE_PI / 6.0 * 1e-6 * 2500.0 / stiffness), restitution, DEM_NAIVE, stiffness);
    dem_world w;
    dem_clump c;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
    assert_int_equal(dem_make_clump(2, at, d, &c), DEM_OK);
    assert_int_equal(dem_add_clumps(&w, 1, &c, centre, NULL, turn, 0, 0), DEM_OK);
    dem_set_motion(&w, 1, dem_vec3(0, 0, -speed), dem_vec3(0, 0, 0));
    assert_int_equal(dem_run(&w, 0.004, DEM_LINEAR), DEM_OK);
    const dem_body b = dem_get_body(&w, 0);
    const double moment = b.moments.x, arm = 0.006 * riddle_sin(tilt), m = 1.0 / (1.0 / b.mass + arm * arm / moment);
    const double zeta = dem_damping_ratio(restitution, DEM_NAIVE) * sqrt(b.mass / m);
    const double e = riddle_exp(-RIDDLE_PI * zeta / sqrt(1.0 - zeta * zeta)), impulse = (1.0 + e) * m * speed;
    error[0] = fabs(b.velocity.z - (impulse / b.mass - speed)) / speed;
    error[1] = fabs(fabs(b.spin.x) / (impulse * arm / moment) - 1.0);
    assert_true(w.touching[0] == 0 && fabs(b.spin.y) + fabs(b.spin.z) < 1e-12);
    dem_free(&w);
}
static void test_two_spheres_hit_as_in_closed_form(void **state) {
    (void)state;
    for (int damped = 0; damped < 2; damped++) {
        double soft[2], hard[2];
        dimer_hit(1e5, damped ? 0.6 : 1.0, soft), dimer_hit(1e7, damped ? 0.6 : 1.0, hard);
        print_message("    k = 1e5, 1e7: velocity %.1e %.1e, spin %.1e %.1e\n", soft[0], hard[0], soft[1], hard[1]);
        assert_true(hard[0] < 2e-3 && hard[1] < 2e-3);
        assert_true(hard[0] < 0.5 * soft[0]);
    }
}

/* Angular momentum about the origin, kinetic energy aside. */
static dem_vec angular_momentum(const dem_world *w) {
    dem_vec sum = dem_vec3(0, 0, 0);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_body b = dem_get_body(w, i);
        if (b.first != i) continue;
        sum = dem__add(sum, dem__add(dem__scale(b.mass, dem__cross(b.position, b.velocity)),
                                     dem__momentum_of(b.axes, b.moments, b.spin)));
    }
    return sum;
}

/* Two clumps of different shapes meet: the momentum stays to 1e-13 of what they have, energy within the ledger. Where a
   contact begins or ends within a step, positions are corrected along its normal; if it slides, that changes the
   angular momentum a little. */
static void test_hits_keep_momentum(void **state) {
    (void)state;
    uint64_t random = 5;
    int hits = 0;
    for (int trial = 0; trial < 24; trial++) {
        dem_def def = hit_def(1e-6, trial % 2 ? 0.5 : 1.0, DEM_CLIPPED, 1e5);
        dem_world w;
        dem_clump c;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        double scale = 0.0, turning = 0.0;
        for (int k = 0; k < 2; k++) {
            double at[9], d[3], turn[4];
            const double x[3] = {k ? 0.012 : -0.012, between(&random, -0.003, 0.003), between(&random, -0.003, 0.003)};
            for (int a = 0; a < 9; a++) at[a] = between(&random, -0.004, 0.004);
            for (int a = 0; a < 3; a++) d[a] = between(&random, 0.006, 0.01);
            for (int a = 0; a < 4; a++) turn[a] = between(&random, -1, 1);
            assert_int_equal(dem_make_clump(3, at, d, &c), DEM_OK);
            assert_int_equal(dem_add_clumps(&w, 1, &c, x, NULL, turn, 0, 0), DEM_OK);
            const ptrdiff_t i = w.count - 1;
            dem_vec v = vector_between(&random, -0.2, 0.2);
            v.x = k ? -1.0 : 1.0;
            dem_set_motion(&w, i, v, vector_between(&random, -100.0, 100.0));
            scale += dem_get_body(&w, i).mass, turning += dem_get_body(&w, i).mass * 0.012;
        }
        const dem_vec p = dem_momentum(&w), l = angular_momentum(&w);
        assert_int_equal(dem_run(&w, 0.02, DEM_LINEAR | (trial % 3 ? DEM_FRICTION : 0) | DEM_ENERGY), DEM_OK);
        assert_true(dem__length(dem__sub(dem_momentum(&w), p)) < 1e-13 * scale);
        const double lost = trial % 2 ? 5e-10 : 2e-12; /* the largest of 600 hits: 2.6e-10 damped, 1.4e-12 undamped */
        assert_true(dem__length(dem__sub(angular_momentum(&w), l)) < lost * turning);
        const dem_energy_ledger e = dem_energy(&w);
        assert_true(fabs(e.error) < 2e-3 * e.start);
        hits += w.contact_steps > 0;
        dem_free(&w);
    }
    assert_true(hits >= 16);
}

/* A box of clumps of two shapes, spheres among them, falls and settles. */
static void fill_scene(dem_world *w, int threads, int skip, int periodic) {
    dem_def def = hit_def(4e-6, 0.6, DEM_CLIPPED, 2e4);
    def.threads = threads, def.skip = skip, def.gravity = dem_vec3(0.5, 0, -9.81);
    if (periodic) def.periodic[0] = 1, def.low.x = -0.03, def.high.x = 0.03;
    dem_clump rod, corner;
    const double line[9] = {0, 0, 0, 0.003, 0, 0, 0.006, 0, 0}, bent[9] = {0, 0, 0, 0.004, 0, 0, 0, 0.003, 0.001},
                 d[3] = {0.005, 0.005, 0.005};
    const double wide[3] = {0.006, 0.005, 0.004};
    uint64_t random = 11;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
    for (int a = 0; a < 4; a++) {
        const dem_vec n = dem_vec3(a < 2 ? 1 - 2 * a : 0, a < 2 ? 0 : 5 - 2 * a, 0);
        if (a >= 2 || !periodic) dem_add_plane(w, 0, dem__scale(-0.03, n), n);
    }
    dem_add_box(w, 0, dem_vec3(-0.05, -0.05, -0.01), dem_vec3(0.05, 0.05, 0));
    assert_int_equal(dem_make_clump(3, line, d, &rod), DEM_OK);
    assert_int_equal(dem_make_clump(3, bent, wide, &corner), DEM_OK);
    for (int k = 0; k < 75; k++) {
        const double x[3] = {0.0115 * (k % 5 - 2), 0.0115 * (k / 5 % 5 - 2), 0.012 * (k / 25) + 0.008};
        double q[4];
        for (int a = 0; a < 4; a++) q[a] = between(&random, -1, 1);
        if (k % 7 == 3) assert_int_equal(dem_add_spheres(w, 1, x, d, 0, 0), DEM_OK);
        else assert_int_equal(dem_add_clumps(w, 1, k % 2 ? &rod : &corner, x, NULL, q, 0, 0), DEM_OK);
        dem_vec v = vector_between(&random, -0.2, 0.2);
        v.z = -0.3;
        dem_set_motion(w, w->count - 1, v, vector_between(&random, -30.0, 30.0));
    }
}

static void test_same_bits_for_threads_and_skipping(void **state) {
    (void)state;
    for (int periodic = 0; periodic < 2; periodic++) {
        uint64_t hash[4];
        for (int k = 0; k < 4; k++) {
            dem_world w;
            fill_scene(&w, k == 1 ? 2 : 1, k == 2 ? 0 : k == 3 ? DEM_SKIP_PAIRS : DEM_SKIP_ALL, periodic);
            assert_int_equal(dem_run(&w, 0.03, DEM_LINEAR | DEM_FRICTION), DEM_OK);
            assert_true(w.contact_steps > 1000);
            hash[k] = dem_hash(&w);
            dem_free(&w);
        }
        assert_true(hash[1] == hash[0] && hash[2] == hash[0] && hash[3] == hash[0]);
    }
}

/* The ledger of a settling bed closes, better with a smaller step; saved in the middle, it goes on with
   the same bits. */
static void test_bed_of_clumps_closes_the_ledger(void **state) {
    (void)state;
    double part[2];
    for (int k = 0; k < 2; k++) {
        dem_world w;
        fill_scene(&w, 1, DEM_SKIP_ALL, k);
        if (k == 0) dem_set_time_step(&w, 2e-6);
        assert_int_equal(dem_run(&w, 0.06, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY), DEM_OK);
        static unsigned char buffer[1 << 20];
        const size_t size = dem_save(&w, buffer, sizeof buffer);
        dem_world v;
        assert_true(size < sizeof buffer);
        assert_int_equal(dem_load(&v, buffer, size, NULL), DEM_OK);
        assert_int_equal(dem_run(&w, 0.06, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY), DEM_OK);
        assert_int_equal(dem_run(&v, 0.06, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY), DEM_OK);
        assert_true(dem_hash(&w) == dem_hash(&v));
        const dem_energy_ledger e = dem_energy(&w);
        part[k] = fabs(e.error) / (e.released + e.start - e.start_potential);
        assert_true(e.kinetic < 0.3 * e.released && e.rotational > 0.0);
        dem_free(&w), dem_free(&v);
    }
    print_message("    error of the ledger over released energy: %.1e at 2e-6 s, %.1e at 4e-6 s, periodic\n", part[0],
                  part[1]);
    assert_true(part[0] < 2e-3 && part[1] < 4e-3);
}

/* Whole clumps leave: by an exit, by dem_remove, by a region. */
static void test_clumps_leave_whole(void **state) {
    (void)state;
    dem_world w;
    fill_scene(&w, 1, DEM_SKIP_ALL, 0);
    const ptrdiff_t all = w.count;
    ptrdiff_t i = 0;
    while (dem_get_body(&w, i).pieces == 1) i++;
    const double d = dem_get_body(&w, i).diameter;
    assert_true(d > 0.005 && d < 0.01);
    assert_int_equal(dem_remove(&w, i + 1), DEM_OK);
    dem_add_exit(&w, dem_vec3(0, 0, 0.011), dem_vec3(0, 0, 1));
    assert_int_equal(dem_run(&w, 0.03, DEM_LINEAR | DEM_FRICTION), DEM_OK);
    ptrdiff_t left = 0, bodies = 0, pieces = 0;
    for (ptrdiff_t k = 0; k < w.count; k++) {
        left += w.alive[k] != 0;
        if (w.alive[k] && dem_get_body(&w, k).first == k) bodies++, pieces += dem_get_body(&w, k).pieces;
    }
    assert_true(left == pieces && w.passed_count > 20 && w.passed_count + bodies == 74);
    assert_true(left < all - 3);
    const dem_region half = dem_box_region(dem_vec3(-1, -1, -1), dem_vec3(0, 1, 1));
    const ptrdiff_t removed = dem_remove_region(&w, &half);
    assert_true(removed > 0 && removed < bodies);
    assert_int_equal(dem_run(&w, 0.005, DEM_LINEAR | DEM_FRICTION), DEM_OK);
    for (ptrdiff_t k = 0; k < w.count; k++) {
        const dem_body b = dem_get_body(&w, k);
        if (w.alive[k]) assert_true(k >= b.first && k < b.first + b.pieces);
    }
    dem_free(&w);
}

/* Springs between surfaces, for links. */
enum { SPRING_K, SPRING_LENGTH, SPRING_STATES };
DEM_INLINE void spring_force(const dem_contact *c, double *state, dem_response *r) {
    r->normal = -state[SPRING_K] * (c->gap - state[SPRING_LENGTH]);
    r->tangential[0] = r->tangential[1] = r->tangential[2] = 0.0;
    r->ended = 0.0;
}
static double no_constants(const dem_birth *birth, double *constants) {
    (void)birth, (void)constants;
    return 0.0;
}
static const dem_law spring_law = {"springs", 1, SPRING_STATES, 0, 0, 0, no_constants, spring_force, NULL, NULL};
DEM_LINK_KERNEL(spring_kernel, spring_law)

/* Two clumps tied to each other and to a sphere by springs at three of their spheres swing and turn: momenta stay, and
   kinetic energy and that of the springs, to the second order of the interval. */
static double tied_error(double interval) {
    dem_def def = hit_def(1e-5, 1.0, DEM_CLIPPED, 1e4);
    dem_world w;
    dem_clump c;
    const double at[9] = {0, 0, 0, 0.01, 0, 0, 0, 0.01, 0}, d[3] = {0.008, 0.008, 0.008},
                 x[9] = {0, 0, 0, 0.03, 0, 0.01, 0.015, 0.03, 0};
    const double spring[SPRING_STATES] = {2.0, 0.01};
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_make_clump(3, at, d, &c), DEM_OK);
    assert_int_equal(dem_add_clumps(&w, 2, &c, x, NULL, NULL, 0, 0), DEM_OK);
    dem_add_spheres(&w, 1, x + 6, d, 0, 0);
    assert_int_equal(dem_set_links(&w, &spring_kernel, interval, 1e-6), DEM_OK);
    assert_int_equal(dem_add_link(&w, 0, 1, 0, spring), DEM_BAD_ARGUMENT); /* of one body */
    assert_int_equal(dem_add_link(&w, 1, 3, 0, spring), DEM_OK);
    assert_int_equal(dem_add_link(&w, 2, 5, 0, spring), DEM_OK);
    assert_int_equal(dem_add_link(&w, 2, 6, 0, spring), DEM_OK);
    dem_set_motion(&w, 0, dem_vec3(0, 0.02, 0.01), dem_vec3(2, 0, 1));
    dem_set_motion(&w, 3, dem_vec3(0, -0.02, -0.01), dem_vec3(0, -1, 2));
    const dem_vec p = dem_momentum(&w), l = angular_momentum(&w);
    double first = 0.0, error = 0.0;
    for (int k = 0; k < 20; k++) {
        assert_int_equal(dem_run(&w, k ? 0.002 : 2.0 * interval, DEM_LINEAR | DEM_ENERGY), DEM_OK);
        double stored = 0.0;
        for (ptrdiff_t q = 0; q < dem_link_count(&w); q++) {
            const dem_contact_info info = dem_get_link(&w, q);
            stored += 0.5 * info.state[SPRING_K] * (info.gap - info.state[SPRING_LENGTH]) *
                      (info.gap - info.state[SPRING_LENGTH]);
        }
        const dem_energy_ledger e = dem_energy(&w);
        const double now = e.kinetic + e.rotational + stored;
        if (k == 0) first = now;
        error = fabs(now - first) > error ? fabs(now - first) : error;
        assert_true(fabs(e.error) < 5e-3 * first);
    }
    assert_true(dem__length(dem__sub(dem_momentum(&w), p)) < 1e-13 * dem_mass(&w, 0));
    assert_true(dem__length(dem__sub(angular_momentum(&w), l)) < 1e-11 * dem__length(l));
    dem_free(&w);
    return error / first;
}
static void test_links_between_clumps(void **state) {
    (void)state;
    const double coarse = tied_error(4e-4), fine = tied_error(1e-4);
    print_message("    energy error with links every 4e-4 s, 1e-4 s: %.1e %.1e\n", coarse, fine);
    assert_true(coarse < 1e-3 && fine < 0.1 * coarse);
}

/* A feed of clumps: orientations at random, none overlaps, all within the region, sizes and mass as asked. */
static void test_feed_of_clumps(void **state) {
    (void)state;
    dem_def def = hit_def(2e-6, 0.6, DEM_CLIPPED, 1e5);
    dem_world w;
    dem_clump c;
    const double at[9] = {0, 0, 0, 0.7, 0, 0, 1.2, 0.4, 0}, d[3] = {1, 0.8, 0.6};
    assert_int_equal(dem_make_clump(3, at, d, &c), DEM_OK);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
    dem_feed feed = dem_default_feed();
    feed.region = dem_box_region(dem_vec3(-0.02, -0.02, -0.01), dem_vec3(0.02, 0.02, 0.03));
    feed.sizes = dem_uniform_sizes(2e-3, 4e-3, 0);
    feed.clump = &c;
    feed.velocity = dem_vec3(0, 0, -0.1), feed.scatter = dem_vec3(0.1, 0.1, 0.1);
    assert_int_equal(dem_fill(&w, &feed, 300), DEM_OK);
    assert_true(feed.placed + feed.missed == 300 && feed.placed > 250 && w.count == 3 * feed.placed);
    double mass = 0.0, moment[3] = {0, 0, 0};
    for (ptrdiff_t i = 0; i < w.count; i++) {
        const dem_vec x = dem_position(&w, i);
        const dem_body b = dem_get_body(&w, i);
        const double r = dem_radius(&w, i);
        assert_true(fabs(x.x) + r < 0.02 + 1e-9 && fabs(x.y) + r < 0.02 + 1e-9 && x.z - r > 0.0 &&
                    x.z + r < 0.03 + 1e-9);
        for (ptrdiff_t k = 0; k < b.first; k++)
            assert_true(dem__length(dem__sub(dem_position(&w, k), x)) > r + dem_radius(&w, k));
        if (b.first != i) continue;
        const dem_vec e = dem__to_lab(b.orientation, dem_vec3(0, 0, 1));
        mass += b.mass, moment[0] += e.x * e.x, moment[1] += e.y * e.y, moment[2] += e.z * e.z;
        assert_true(b.diameter > 2e-3 * (1 - 1e-12) && b.diameter < 4e-3 * (1 + 1e-12) &&
                    fabs(b.velocity.z + 0.1) <= 0.1);
    }
    assert_true(fabs(mass / feed.placed_mass - 1.0) < 1e-12);
    /* 4.6 standard deviations */
    for (int a = 0; a < 3; a++) assert_true(fabs(moment[a] / (double)feed.placed - 1.0 / 3.0) < 0.08);
    assert_int_equal(dem_run(&w, 0.01, DEM_LINEAR | DEM_FRICTION), DEM_OK);
    feed.region = dem_box_region(dem_vec3(-0.02, -0.02, 0.05), dem_vec3(0.02, 0.02, 0.05)); /* a face */
    const ptrdiff_t before = feed.placed;
    assert_int_equal(dem_feed_mass(&w, &feed, 0.01, 0.1), DEM_OK);
    assert_true(feed.placed > before);
    dem_clump broken = c;
    broken.spheres = 0, feed.clump = &broken;
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT);
    dem_free(&w);
}

/* What is measured counts a clump once: mass, momentum, volume; and at rest the contacts carry the weight. */
static void test_measures_count_a_clump_once(void **state) {
    (void)state;
    dem_world w;
    fill_scene(&w, 1, DEM_SKIP_ALL, 0);
    dem_measure m;
    dem_region all = dem_box_region(dem_vec3(-0.1, -0.1, -0.1), dem_vec3(0.1, 0.1, 0.1));
    double mass = 0.0, volume = 0.0;
    ptrdiff_t bodies = 0;
    for (ptrdiff_t i = 0; i < w.count; i++) {
        const dem_body b = dem_get_body(&w, i);
        if (b.first == i) mass += b.mass, volume += b.mass / 2500.0, bodies++;
    }
    const dem_vec p = dem_momentum(&w);
    assert_int_equal(dem_measure_region(&w, &all, &m), DEM_OK);
    assert_true(m.count == bodies && fabs(m.mass / mass - 1.0) < 1e-13);
    assert_true(fabs(m.solid_fraction * 8e-3 / volume - 1.0) < 1e-12);
    assert_true(dem__length(dem__sub(dem__scale(m.mass, m.velocity), p)) < 1e-12 * dem__length(p));
    dem_cells cells;
    dem_field field[8];
    memset(&cells, 0, sizeof cells);
    cells.low = all.low, cells.high = all.high;
    for (int a = 0; a < 3; a++) cells.n[a] = 2;
    assert_int_equal(dem_coarse_grain(&w, &cells, field), DEM_OK);
    double density = 0.0;
    for (int k = 0; k < 8; k++) density += field[k].density * 1e-3;
    assert_true(fabs(density / mass - 1.0) < 1e-13);
    dem_free(&w);
    /* a rod on two feet at rest: sum of F L over the volume is the weight times the height of its centre */
    const double rod[6] = {0, 0, 0, 0.02, 0, 0}, d[2] = {0.01, 0.01}, x[3] = {0, 0, 0.005};
    dem_def def = hit_def(1e-5, 0.2, DEM_CLIPPED, 1e4);
    dem_clump c;
    def.gravity = dem_vec3(0, 0, -9.81);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
    assert_int_equal(dem_make_clump(2, rod, d, &c), DEM_OK);
    assert_int_equal(dem_add_clumps(&w, 1, &c, x, NULL, NULL, 0, 0), DEM_OK);
    assert_int_equal(dem_run(&w, 1.0, DEM_LINEAR | DEM_FRICTION), DEM_OK);
    assert_int_equal(dem_measure_region(&w, &all, &m), DEM_OK);
    const dem_body b = dem_get_body(&w, 0);
    assert_true(m.coordination == 2.0 &&
                fabs(m.contact_stress[2][2] * 8e-3 / (b.mass * 9.81 * b.position.z) - 1.0) < 1e-3);
    assert_true(fabs(m.contact_stress[0][0]) < 1e-6 * m.contact_stress[2][2]);
    assert_true(fabs(b.position.z - (0.005 - 0.5 * b.mass * 9.81 / 1e4)) < 1e-9);
    dem_free(&w);
}

/* A plate of side x side spheres lands flat at the advised step: as with a twentieth of it, and the books balance. */
static double land_plate(int side, double e, double share, int reload, double *error) {
    dem_def def = dem_default_def();
    double centre[192], diameter[64];
    const double at[3] = {0.0, 0.0, 1.001e-3};
    const int features = DEM_LINEAR | DEM_FRICTION | DEM_ENERGY;
    dem_clump plate;
    dem_world w;
    dem_add_material(&def, 2000.0, 1e8, 0.25);
    dem_pair(&def, 0, 0)->stiffness = 1e4, dem_pair(&def, 0, 0)->restitution = e;
    def.gravity = dem_vec3(0.0, 0.0, 0.0);
    for (int k = 0; k < side * side; k++)
        centre[3 * k] = k % side * 2e-3, centre[3 * k + 1] = k / side * 2e-3, centre[3 * k + 2] = 0.0,
                   diameter[k] = 2e-3;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_true(dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) >= 0);
    assert_int_equal(dem_make_clump(side * side, centre, diameter, &plate), DEM_OK);
    assert_int_equal(dem_add_clumps(&w, 1, &plate, at, NULL, NULL, 0, 0), DEM_OK);
    if (reload) {
        unsigned char bytes[60000];
        dem_world loaded;
        const size_t size = dem_save(&w, NULL, 0);
        assert_true(size <= sizeof bytes && dem_save(&w, bytes, size) == size);
        assert_int_equal(dem_load(&loaded, bytes, size, NULL), DEM_OK);
        dem_free(&w);
        w = loaded;
    }
    assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0.0, 0.0, -0.1), dem_vec3(0.0, 0.0, 0.0)), DEM_OK);
    assert_int_equal(dem_set_time_step(&w, share * dem_advise(&w, features, 0.1).advised), DEM_OK);
    assert_int_equal(dem_run(&w, 6e-4, features), DEM_OK);
    assert_true(w.step_ratio < 0.251 * share);
    const double v = dem_get_body(&w, 0).velocity.z;
    *error = fabs(dem_energy(&w).error) / (0.005 * dem_get_body(&w, 0).mass);
    dem_free(&w);
    return v / 0.1;
}
static void test_flat_clump_at_the_advised_step(void **state) {
    (void)state;
    const double restitution[4] = {0.8, 0.5, 0.2, 0.05};
    for (int k = 0; k < 12; k++) {
        double coarse, fine;
        const double e = restitution[k % 4];
        const int side = 2 << k / 4;
        const double v = land_plate(side, e, 1.0, k % 2, &coarse), exact = land_plate(side, e, 0.05, 0, &fine);
        if (!(v > -1e-6 && fabs(v - exact) < 0.02 && coarse < 0.15 && fine < 0.01))
            fail_msg("%d spheres, restitution %g: leaves at %g, exactly %g; error %g", side * side, e, v, exact,
                     coarse);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_euler_top_flies_to_the_reference),
        cmocka_unit_test(test_drift_of_three_moments_has_its_order),
        cmocka_unit_test(test_brick_top),
        cmocka_unit_test(test_top_turns_for_long),
        cmocka_unit_test(test_axes_in_any_order),
        cmocka_unit_test(test_energy_of_a_torqued_top_does_not_drift),
        cmocka_unit_test(test_loaded_top_closes_the_ledger),
        cmocka_unit_test(test_saved_and_loaded),
        cmocka_unit_test(test_bad_arguments),
        cmocka_unit_test(test_shapes_have_their_mass_properties),
        cmocka_unit_test(test_unions_of_spheres),
        cmocka_unit_test(test_shapes_are_checked),
        cmocka_unit_test(test_clump_of_one_is_a_sphere),
        cmocka_unit_test(test_two_spheres_hit_as_in_closed_form),
        cmocka_unit_test(test_hits_keep_momentum),
        cmocka_unit_test(test_same_bits_for_threads_and_skipping),
        cmocka_unit_test(test_bed_of_clumps_closes_the_ledger),
        cmocka_unit_test(test_clumps_leave_whole),
        cmocka_unit_test(test_links_between_clumps),
        cmocka_unit_test(test_feed_of_clumps),
        cmocka_unit_test(test_flat_clump_at_the_advised_step),
        cmocka_unit_test(test_measures_count_a_clump_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
