/* examples/angle_of_repose: steeper with more friction, within what spheres do; the funnel comes through its own file. */
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
    const double d = 5e-3, friction[2] = {0.05, 0.6}, points[3][2] = {{2.8 * d, 0.0}, {2.8 * d, 2.0 * d}, {9.0 * d, 10.0 * d}};
    dem_mesh funnel = lathe(points, 3);
    heap h[2];
    progress bar;
    assert_true(funnel.triangles == 4 * AROUND);
    common_set_quiet(true);
    memset(h, 0, sizeof h);
    progress_begin(&bar, "pouring", 2);
    for (int k = 0; k < 2; k++) {
        h[k].diameter = d, h[k].friction = friction[k], h[k].rolling = 0.02, h[k].spheres = 800, h[k].seed = 3;
        h[k].funnel = &funnel, h[k].bar = &bar;
        pour(&h[k]);
        assert_int_equal(h[k].status, DEM_OK);
        assert_true(h[k].on_plate > 300 && h[k].on_plate < 800 && h[k].speed < 0.1);
    }
    progress_end(&bar);
    assert_true(h[0].angle > -0.05 && h[0].angle < 0.25 && h[1].angle > 0.2 && h[1].angle < 0.6 && h[1].angle > h[0].angle + 0.1);
    free(funnel.vertex), free(funnel.triangle);
}

/* The error is that of the mean of heaps: of angles whose scatter is known. */
static void test_error_of_heaps(void **state) {
    (void)state;
    heap h[4];
    double mean, error;
    memset(h, 0, sizeof h);
    h[0].angle = 0.30, h[1].angle = 0.34, h[2].angle = 0.32, h[3].angle = 0.36;
    average(h, 4, &mean, &error);
    assert_true(fabs(mean - 0.33) < 1e-12 && fabs(error - sqrt(0.002 / 3.0 / 4.0)) < 1e-12);
    average(h, 1, &mean, &error);
    assert_true(mean == 0.30 && isnan(error));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_trend), cmocka_unit_test(test_error_of_heaps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
