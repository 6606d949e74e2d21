/* Force fields and gas of dem.h: flights by steps of their own, drag, the gas that turns with the walls. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "dem.h"

#include "failing_allocator.h"

DEM_GAS(stokes, dem_drag_stokes)
DEM_GAS(schiller, dem_drag_schiller_naumann)
DEM_GAS(hoelzer, dem_drag_hoelzer_sommerfeld)

static const double eta = 1.81e-5, density = 2700.0;

static dem_def grains(double dt) {
    dem_def def = dem_default_def();
    dem_add_material(&def, density, 1e9, 0.3);
    dem_pair(&def, 0, 0)->stiffness = 200.0;
    dem_pair(&def, 0, 0)->restitution = 0.5;
    def.dt = dt;
    return def;
}
static void add(dem_world *w, double x, double y, double z, double d, dem_vec v) {
    const double centre[3] = {x, y, z};
    assert_int_equal(dem_add_spheres(w, 1, centre, &d, 0, 0), DEM_OK);
    assert_int_equal(dem_set_motion(w, w->count - 1, v, dem_vec3(0, 0, 0)), DEM_OK);
}

/* Relaxation to the terminal velocity by Stokes's law, in closed form. */
static void relaxation(void **state) {
    (void)state;
    const double d = 20e-6, tau = density * d * d / 18.0 / eta;
    dem_gas air = dem_default_gas();
    dem_force_field f = dem_gas_field(stokes, &air);
    dem_def def = grains(1e-7);
    for (int run = 0; run < 3; run++) {
        dem_world w;
        f.accuracy = run == 1 ? 1e-9 : 1e-6;
        air.buoyancy = run == 2;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        add(&w, 0, 0, 0, d, dem_vec3(3.0, 0, 0));
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        const double g = -9.81 * (air.buoyancy ? 1.0 - air.density / density : 1.0);
        for (int k = 0; k < 8; k++) {
            assert_int_equal(dem_run(&w, 0.5 * tau, DEM_LINEAR), DEM_OK);
            const double t = w.time, e = exp(-t / tau);
            const dem_vec x = dem_position(&w, 0), v = dem_velocity(&w, 0);
            if(getenv("SAY")) printf("t/tau %.2f x err %.2e z err %.2e v err %.2e %.2e\n", t / tau, x.x / (3.0 * tau * (1 - e)) - 1, x.z / (g * tau * (t - tau * (1 - e))) - 1,
                   v.x / (3.0 * e) - 1.0, v.z / (g * tau * (1 - e)) - 1);
        }
        dem_free(&w);
    }
}


/* A box with spheres of three sizes, stirred by a turning paddle; what flies in it. */
static int stirred(dem_world *w, int skip, int threads, double accuracy, int balls) {
    dem_def def = grains(2e-8);
    uint64_t random = 7;
    def.skip = skip, def.threads = threads;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
    w->def.skip = skip;
    assert_true(dem_add_plane(w, 0, dem_vec3(0, 0, -5e-4), dem_vec3(0, 0, 1)) >= 0);
    assert_true(dem_add_plane(w, 0, dem_vec3(0, 0, 5e-4), dem_vec3(0, 0, -1)) >= 0);
    assert_true(dem_add_cylinder(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 2e-3, 1) >= 0);
    const int paddle = dem_add_box(w, 0, dem_vec3(-1.5e-3, -5e-5, -6e-4), dem_vec3(1.5e-3, 5e-5, 6e-4));
    assert_true(paddle >= 0);
    assert_int_equal(dem_rotate(w, paddle, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 600.0), DEM_OK);
    dem_feed feed = dem_default_feed();
    const double size[3] = {20e-6, 40e-6, 60e-6}, share[3] = {1, 1, 1};
    feed.sizes = dem_size_list(3, size, share, 0);
    feed.region = dem_box_region(dem_vec3(-1.3e-3, -1.3e-3, -4e-4), dem_vec3(1.3e-3, 1.3e-3, 4e-4));
    feed.scatter = dem_vec3(2, 2, 2);
    feed.random = random;
    assert_int_equal(dem_fill(w, &feed, balls), DEM_OK);
    (void)accuracy;
    return paddle;
}
static void say(const dem_world *w, const char *name) {
    if (getenv("SAY"))
        printf("%s: step %lld hash %016llx contacts %td contact steps %lld looks %lld rebuilds %lld %s\n", name, (long long)w->step,
               (unsigned long long)dem_hash(w), dem_contact_count(w), (long long)w->contact_steps, (long long)w->looks,
               (long long)w->rebuilds, dem_status_text(w->status));
}

/* Skipping changes no bit in a field; neither do threads. */
static void skipping_is_exact(void **state) {
    (void)state;
    uint64_t hash[5];
    static const int skips[] = {DEM_SKIP_ALL, 0, DEM_SKIP_PAIRS, DEM_SKIP_SPACE, DEM_SKIP_ALL};
    for (int run = 0; run < 5; run++) {
        dem_world w;
        dem_gas air = dem_default_gas();
        const int paddle = stirred(&w, skips[run], run == 4 ? 3 : 1, 1e-6, 300);
        assert_int_equal(dem_attach_gas(&air, &w, paddle), DEM_OK);
        dem_force_field f = dem_gas_field(schiller, &air);
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        assert_int_equal(dem_run(&w, 4e-4, DEM_LINEAR | DEM_FRICTION), DEM_OK);
        assert_true(w.contact_steps > 1000);
        hash[run] = dem_hash(&w);
        say(&w, "stirred");
        dem_free(&w);
    }
    for (int run = 1; run < 5; run++) assert_true(hash[run] == hash[0]);
}

static dem_vec nothing(const dem_force_point *at) {
    (void)at;
    return dem_vec3(0, 0, 0);
}
DEM_FORCE_FIELD(nothing_field, nothing)

/* A field that is 0 leaves every bit as it is. */
static void no_field_no_change(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int run = 0; run < 2; run++) {
        dem_world w;
        stirred(&w, DEM_SKIP_ALL, 1, 1e-6, 300);
        dem_force_field f = dem_default_force_field(nothing_field, NULL);
        f.length = 1e-4;
        if (run) assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        assert_int_equal(dem_run(&w, 4e-4, DEM_LINEAR | DEM_FRICTION), DEM_OK);
        assert_true(w.contact_steps > 1000);
        hash[run] = dem_hash(&w);
        say(&w, "nothing");
        dem_free(&w);
    }
    assert_true(hash[1] == hash[0]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(relaxation), cmocka_unit_test(skipping_is_exact), cmocka_unit_test(no_field_no_change)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
