/* examples/sieve_blocking/sieve_patch.h: the periodic sieve of sieve_blocking --simulate. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <stdio.h>

#include "../examples/sieve_blocking/sieve_patch.h"

enum { FEATURES = DEM_LINEAR | DEM_FRICTION };

static void empty(sieve_patch *p, int across) {
    sieve_patch_def def = sieve_patch_default();
    def.across = across;
    def.overlap = 0.002;
    assert_int_equal(sieve_patch_make(p, &def), DEM_OK);
}
static void add(sieve_patch *p, double x, double y, double z, double d) {
    const double at[3] = {x, y, z};
    assert_int_equal(dem_add_spheres(&p->world, 1, at, &d, 0, 0), DEM_OK);
}
static const double l = 1e-3, pitch = 1.5e-3;

/* The same throw within the patch and across each of its sides, over bars: a periodic side is no place. */
static void test_sides_are_no_place(void **state) {
    (void)state;
    static const double from[][2] = {{0.1, 0.5}, {0.9, 0.2}, {0.5, 0.9}, {0.05, 0.05}},
                        towards[][2] = {{-0.05, 0.01}, {0.06, 0.02}, {0.01, 0.05}, {-0.04, -0.05}};
    for (int k = 0; k < 4; k++) {
        dem_vec end[3], velocity[3];
        int n = 0;
        for (int shift = 0; shift < 3; shift++) { /* cell 3 of 8, the first, the last */
            sieve_patch p;
            const double cell = shift == 0 ? 3.0 : shift == 1 ? 0.0 : 7.0;
            empty(&p, 8);
            const double x = (cell + from[k][0]) * pitch, y = (cell + from[k][1]) * pitch;
            add(&p, x, y, 1.5e-3, 1.3 * l);
            dem_set_motion(&p.world, 0, dem_vec3(towards[k][0], towards[k][1], 0.0), dem_vec3(0.0, 0.0, 0.0));
            sieve_patch_set_step(&p);
            assert_int_equal(dem_run(&p.world, 0.06, FEATURES), DEM_OK);
            const dem_vec at = dem_position(&p.world, 0);
            end[n] = dem_vec3(at.x - cell * pitch, at.y - cell * pitch, at.z);
            velocity[n++] = dem_velocity(&p.world, 0);
            dem_free(&p.world);
        }
        for (int q = 1; q < 3; q++) {
            double dx = end[q].x - end[0].x, dy = end[q].y - end[0].y, side = 8.0 * pitch;
            dx -= side * floor(dx / side + 0.5), dy -= side * floor(dy / side + 0.5);
            if (!(fabs(dx) < 1e-8 && fabs(dy) < 1e-8 && fabs(end[q].z - end[0].z) < 1e-8))
                fail_msg("throw %d, side %d: off by %g, %g, %g m", k, q, dx, dy, end[q].z - end[0].z);
            assert_true(dem__length(dem__sub(velocity[q], velocity[0])) < 1e-5);
        }
    }
}

/* A grain pressed into a hole by 100 times its weight and let go: it stays, turned over, if the wires' normals lie
   within the friction cone, d < pitch sqrt(1 + mu^2) - wire = 1.066 l; it passes if it is smaller than the hole. Merely
   laid on, it falls out. */
static void test_wedge(void **state) {
    (void)state;
    static const struct {
        double d, press;
        int stays;
    } grain[] = {{0.97, 0.0, -1},  {1.03, 0.0, 0},   {1.02, 100.0, 1},
                 {1.05, 100.0, 1}, {1.09, 100.0, 0}, {1.3, 100.0, 0}};
    for (int k = 0; k < 6; k++) {
        sieve_patch p;
        empty(&p, 8);
        add(&p, 0.5 * pitch, 3.5 * pitch, 0.8 * l, grain[k].d * l); /* beside a periodic side */
        sieve_patch_set_step(&p);
        assert_int_equal(dem_run(&p.world, 0.1, FEATURES), DEM_OK);
        if (grain[k].stays < 0) {
            assert_int_equal(p.world.passed_count, 1);
        } else {
            const double weight = dem_mass(&p.world, 0) * 9.81;
            for (int s = 0; s <= 200; s++) { /* up and down, slowly */
                const double f = -grain[k].press * weight * (s < 100 ? s : 200 - s) / 100.0;
                assert_int_equal(dem_set_load(&p.world, 0, dem_vec3(0.0, 0.0, f), dem_vec3(0.0, 0.0, 0.0)), DEM_OK);
                assert_int_equal(dem_run(&p.world, 2e-4, FEATURES), DEM_OK);
            }
            assert_int_equal(dem_count_apertures(&p.world, p.deck).occupied, 1);
            assert_int_equal(sieve_patch_blocked(&p), grain[k].stays);
        }
        dem_free(&p.world);
    }
}

static void test_a_run(void **state) {
    (void)state;
    uint64_t hash[3];
    int blocked[3][2];
    for (int k = 0; k < 3; k++) {
        sieve_patch p;
        sieve_patch_def def = sieve_patch_default();
        def.across = 8;
        def.overlap = 0.02;
        def.threads = k == 1 ? 2 : 1;
        def.seed = k == 2 ? 3 : 1;
        assert_int_equal(sieve_patch_make(&p, &def), DEM_OK);
        assert_int_equal(sieve_patch_lay(&p), DEM_OK);
        assert_true(fabs(p.mass / (def.load * 64.0 * pitch * pitch) - 1.0) < 0.05 &&
                    fabs(p.hard_mass / p.mass - def.x_h) < 0.05);
        blocked[k][0] = sieve_patch_blocked(&p);
        const uint64_t before = dem_hash(&p.world);
        /* Counting disturbs nothing. */
        assert_true(sieve_patch_blocked(&p) == blocked[k][0] && dem_hash(&p.world) == before);
        assert_int_equal(sieve_patch_vibrate(&p, 12), DEM_OK);
        blocked[k][1] = sieve_patch_blocked(&p);
        assert_true(blocked[k][0] >= 0 && blocked[k][1] < 32);
        hash[k] = dem_hash(&p.world);
        const dem_wall *deck = &p.world.wall[p.deck];
        assert_true(fabs(deck->velocity.z) < 1e-4 && fabs(deck->position.z) < 1e-9); /* at rest after whole periods */
        double z = deck->position.z;
        assert_int_equal(dem_run(&p.world, 0.5 / def.frequency, FEATURES), DEM_OK);
        assert_true(fabs(z - deck->position.z - 2.0 * sieve_patch_amplitude(&def)) < 1e-8);
        assert_true(
            fabs(4.0 * RIDDLE_PI * RIDDLE_PI * def.frequency * def.frequency * sieve_patch_amplitude(&def) / 9.81 -
                 def.K) < 1e-14);
        for (ptrdiff_t q = 0; q < p.world.passed_count; q++) assert_true(p.world.passed[q].diameter < 1.05 * l);
        dem_free(&p.world);
    }
    assert_true(hash[0] == hash[1] && hash[0] != hash[2]);
    assert_true(blocked[0][1] == blocked[1][1]);
    /* seeds 1 to 8: 1.6 at first, 4.8 after; one of them may stay as it is */
    assert_true(blocked[0][1] + blocked[2][1] > 1.5 * (blocked[0][0] + blocked[2][0]));
}

static void test_bad_definitions(void **state) {
    (void)state;
    const double bad[] = {0.0, -1.0, (double)NAN, (double)INFINITY};
    for (int k = 0; k < 4; k++) {
        for (int field = 0; field < 5; field++) {
            sieve_patch_def def = sieve_patch_default();
            double *const fields[] = {&def.opening, &def.wire, &def.overlap, &def.density, &def.load};
            *fields[field] = bad[k];
            def.across = 8;
            sieve_patch p;
            dem_status status = sieve_patch_make(&p, &def);
            if (status == DEM_OK) status = sieve_patch_lay(&p);
            assert_int_not_equal(status, DEM_OK);
            dem_free(&p.world);
        }
    }
}

/* With refill each grain that passed is replaced by an equal one: number and mass on the sieve stay;
   without, they fall. */
static void test_refill_keeps_the_layer(void **state) {
    (void)state;
    for (int refill = 0; refill <= 1; refill++) {
        sieve_patch_def def = sieve_patch_default();
        sieve_patch p;
        double mass = 0.0;
        ptrdiff_t present = 0;
        def.across = 6, def.load = 0.5, def.overlap = 0.04, def.refill = refill, def.slope = 0.26, def.circular = 1;
        assert_int_equal(sieve_patch_make(&p, &def), DEM_OK);
        assert_int_equal(sieve_patch_lay(&p), DEM_OK);
        assert_int_equal(sieve_patch_vibrate(&p, 4), DEM_OK);
        assert_true(p.world.passed_total > 10);
        if (refill) assert_true(p.world.passed_count < 10); /* records of those that were replaced are taken */
        if (refill) assert_int_equal(sieve_patch_refill(&p), DEM_OK);
        for (ptrdiff_t i = 0; i < p.world.count; i++)
            if (p.world.alive[i]) present++, mass += dem_mass(&p.world, i);
        assert_int_equal(present, refill ? p.grains : p.grains - (ptrdiff_t)p.world.passed_total);
        if (refill) assert_true(fabs(mass / p.mass - 1.0) < 1e-12);
        else assert_true(mass < 0.99 * p.mass);
        dem_free(&p.world);
    }
    sieve_patch_def def = sieve_patch_default();
    sieve_patch p;
    def.slope = (double)NAN;
    assert_int_equal(sieve_patch_make(&p, &def), DEM_BAD_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_refill_keeps_the_layer),
        cmocka_unit_test(test_sides_are_no_place),
        cmocka_unit_test(test_wedge),
        cmocka_unit_test(test_a_run),
        cmocka_unit_test(test_bad_definitions),
    };
    return cmocka_run_group_tests_name("sieve_patch", tests, NULL, NULL);
}
