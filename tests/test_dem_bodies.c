/* test_dem_bodies.c: orientation and rotation of rigid bodies in dem.h, against closed forms and the 17-digit references of the Euler top
   (Jacobi elliptic functions and quaternions, computed with 40 digits). */
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
static const double TOP_AT[3][5] = {{1, .77903960258822208, .35820926595727759, .1958299706947999, .4758508610470377},
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
    assert_true(fabs(spin.x + .921069998444332243) + fabs(spin.y - .38939704411533198) + fabs(spin.z - .974400660583082425) < 1e-9);
    assert_int_equal(w.engine->bodies.active_count, 0); /* in flight: it takes no steps */
    dem_free(&w);
}

/* Order of a drift, by errors at t = 10 with steps of h and h/2. */
static double drift_error(double h, int far) {
    const dem_vec moments = dem_vec3(1, 2, 3), momentum = dem_vec3(1, 0, 3);
    dem_quaternion q = ONE;
    const int n = (int)(10.0 / h + 0.5);
    for (int k = 0; k < n; k++) q = far ? dem__turn_far(q, momentum, moments, h) : dem__turn_split(q, momentum, moments, h);
    return quaternion_error(q, TOP_AT[2] + 1);
}
static void test_drift_of_three_moments_has_its_order(void **state) {
    (void)state;
    const double ratio = drift_error(0.1, 0) / drift_error(0.05, 0);
    print_message("    splitting, h = 0.1: %.2e, order %.2f\n", drift_error(0.1, 0), riddle_log(ratio) / riddle_log(2.0));
    assert_true(ratio > 3.8 && ratio < 4.2);
    assert_true(drift_error(0.1, 0) < 5e-3);
    print_message("    sixth order, h = 10, 0.025, 0.0125: %.2e %.2e %.2e\n", drift_error(10.0, 1), drift_error(0.025, 1),
                  drift_error(0.0125, 1));
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
        const dem_vec v = dem_spin(&w, i), x = dem__to_lab(dem_orientation(&w, i), dem_vec3(k == 0, k == 2, k == 1)); /* axis 0 of m */
        const double of[3] = {v.x, v.y, v.z}, at[3] = {x.x, x.y, x.z};
        spin[k] = dem_vec3(of[(3 - k) % 3], of[(4 - k) % 3], of[(5 - k) % 3]);
        e[k] = dem_vec3(at[(3 - k) % 3], at[(4 - k) % 3], at[(5 - k) % 3]);
        assert_true(dem__length(dem__sub(spin[k], spin[0])) < 1e-13);
        assert_true(dem__length(dem__sub(e[k], e[0])) < 1e-13);
        dem_free(&w);
    }
}

/* A top under the torque of a field, U = R axis . g: kick, drift, kick. Relative drift of its energy over 800, by the
   line that fits best. */
static double torqued_drift(dem_vec moments) {
    const dem_vec g = dem_vec3(0.3, -0.2, 0.5), axis = dem_vec3(0.2, 0.1, 1.0);
    dem_quaternion q = ONE;
    dem_vec l = dem__momentum_of(q, moments, dem_vec3(1, 0.3, 1));
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
static void test_energy_of_a_torqued_top_does_not_drift(void **state) {
    (void)state;
    const double split = torqued_drift(dem_vec3(1, 2, 3)), exact = torqued_drift(dem_vec3(2, 2, 3));
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

        assert_true(fabs(l.x - 1.25) + fabs(l.y - 0.5) + fabs(l.z + 2.0) < 1e-11); /* (1, 1, -3) + 5 (0.05, -0.1, 0.2) */
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
    const dem_quaternion none = {0, 0, 0, 0}, nan = {1, (double)NAN, 0, 0}, wide = {1e300, 1e300, 0, 0}, inf = {1, (double)INFINITY, 0, 0},
                         tiny = {0, 0, 1e-310, 0};
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_euler_top_flies_to_the_reference),
        cmocka_unit_test(test_drift_of_three_moments_has_its_order),
        cmocka_unit_test(test_brick_top),
        cmocka_unit_test(test_axes_in_any_order),
        cmocka_unit_test(test_energy_of_a_torqued_top_does_not_drift),
        cmocka_unit_test(test_loaded_top_closes_the_ledger),
        cmocka_unit_test(test_saved_and_loaded),
        cmocka_unit_test(test_bad_arguments),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
