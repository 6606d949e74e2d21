/* examples/angle_of_repose: steeper with more friction, within what spheres do; the funnel comes through
   its own file. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#define main example_main
#include "../examples/angle_of_repose.c"
#undef main

static void test_trend(void **state) {
    (void)state;
    const double d = 5e-3, friction[2] = {0.05, 0.6},
                 points[3][2] = {{2.8 * d, 0.0}, {2.8 * d, 2.0 * d}, {9.0 * d, 10.0 * d}};
    dem_mesh funnel = lathe(points, 3);
    heap h[2];
    progress bar;
    assert_true(funnel.triangles == 4 * AROUND);
    common_set_quiet(true);
    memset(h, 0, sizeof h);
    progress_begin(&bar, "pouring", 2);
    for (int k = 0; k < 2; k++) {
        h[k].diameter = d, h[k].friction = friction[k], h[k].rolling = 0.02, h[k].spheres = 800, h[k].seed = 3;
        h[k].funnel = &funnel, h[k].bar = &bar, h[k].outlet = 7.0 * d;
        pour(&h[k]);
        assert_int_equal(h[k].status, DEM_OK);
        assert_true(h[k].on_plate > 300 && h[k].on_plate < 800 && h[k].speed < 0.1);
    }
    progress_end(&bar);
    assert_true(!h[0].why && !h[1].why && !h[0].raised && !h[1].raised && h[0].in_funnel == 0);
    assert_true(h[0].angle > -0.05 && h[0].angle < 0.25 && h[1].angle > 0.2 && h[1].angle < 0.6 &&
                h[1].angle > h[0].angle + 0.1);
    free(funnel.vertex), free(funnel.triangle);
}

/* A heap that grows to its funnel lifts it. */
static void test_funnel_rises(void **state) {
    (void)state;
    const double d = 5e-3, points[3][2] = {{2.8 * d, 0.0}, {2.8 * d, 2.0 * d}, {9.0 * d, 10.0 * d}};
    dem_mesh funnel = lathe(points, 3);
    heap h;
    progress bar;
    common_set_quiet(true);
    memset(&h, 0, sizeof h);
    progress_begin(&bar, "pouring", 1);
    h.diameter = d, h.friction = 0.8, h.rolling = 0.2, h.spheres = 350, h.seed = 3;
    h.funnel = &funnel, h.bar = &bar, h.outlet = 3.5 * d;
    pour(&h);
    progress_end(&bar);
    assert_int_equal(h.status, DEM_OK);
    assert_true(h.raised && h.outlet > 5.0 * d && h.in_funnel == 0 && !h.why);
    assert_true(h.angle > 0.35 && h.angle < 0.75 && h.height[0] < h.outlet - d);
    free(funnel.vertex), free(funnel.triangle);
}

/* A cone of spheres that is right; what makes it none that can be measured has its reason. */
static void test_no_angle(void **state) {
    const double d = 5e-3, plate = 8.0 * d, slope = 0.5;
    static const char *const reasons[] = {NULL, "the heap touches the funnel", "the funnel is blocked",
                                          "the heap does not come to rest", "too few spheres stay on the plate"};
    (void)state;
    for (int kind = 0; kind < 5; kind++) {
        dem_world w;
        dem_def def = dem_default_def();
        heap h;
        dem_add_material(&def, 2500.0, 1e8, 0.25);
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        for (double x = -7.5; x < 8.0; x += 1.01)
            for (double y = -7.5; y < 8.0; y += 1.01)
                for (double z = 0.5; z < slope * (8.0 - hypot(x, y)); z += 1.01) {
                    const double centre[3] = {x * d, y * d, z * d};
                    if (kind == 4 && hypot(x, y) < 5.0) continue;
                    assert_int_equal(dem_add_spheres(&w, 1, centre, &d, 0, 0), DEM_OK);
                }
        const double in_funnel[3] = {0.0, 0.0, 12.5 * d};
        if (kind == 2) assert_int_equal(dem_add_spheres(&w, 1, in_funnel, &d, 0, 0), DEM_OK);
        if (kind == 3) dem_set_motion(&w, 5, dem_vec3(0.25, 0.0, 0.0), dem_vec3(0, 0, 0));
        memset(&h, 0, sizeof h);
        h.diameter = d, h.outlet = (kind == 1 ? 4.0 : 12.0) * d;
        judge(&h, &w, dem_vec3(0, 0, 0), plate);
        if (!reasons[kind]) {
            assert_null(h.why);
            assert_true(fabs(tan(h.angle) - slope) < 0.12 && h.on_plate > 100);
        } else {
            assert_non_null(h.why);
            assert_string_equal(h.why, reasons[kind]);
            assert_true(isnan(h.angle));
        }
        dem_free(&w);
    }
}

/* The error is that of the mean of heaps: of angles whose scatter is known. */
static void test_error_of_heaps(void **state) {
    (void)state;
    heap h[4];
    double mean, error;
    memset(h, 0, sizeof h);
    h[0].angle = 0.30, h[1].angle = 0.34, h[2].angle = 0.32, h[3].angle = 0.36;
    assert_int_equal(average(h, 4, &mean, &error), 4);
    assert_true(fabs(mean - 0.33) < 1e-12 && fabs(error - sqrt(0.002 / 3.0 / 4.0)) < 1e-12);
    average(h, 1, &mean, &error);
    assert_true(mean == 0.30 && isnan(error));
    h[1].angle = NAN; /* a heap without an angle counts for nothing */
    assert_int_equal(average(h, 2, &mean, &error), 1);
    assert_true(mean == 0.30 && isnan(error));
    h[0].angle = NAN;
    assert_int_equal(average(h, 2, &mean, &error), 0);
    assert_true(isnan(mean) && isnan(error));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_trend), cmocka_unit_test(test_funnel_rises),
                                       cmocka_unit_test(test_no_angle), cmocka_unit_test(test_error_of_heaps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
