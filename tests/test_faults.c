/* dem.h: faults that users ran into, each with others of its kind: what a caller does between runs stands in the books, records do not
   pile up, what decays comes to rest. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <math.h>

#include "dem.h"

static void near_absolute(double got, double wanted, double tolerance, const char *what) {
    if (!(fabs(got - wanted) <= tolerance)) fail_msg("%s: %.17g, not %.17g (off by %.2g)", what, got, wanted, got - wanted);
}
static void near_relative(double got, double wanted, double tolerance, const char *what) {
    near_absolute(got, wanted, tolerance * fabs(wanted), what);
}
static dem_vec v3(double x, double y, double z) { return dem_vec3(x, y, z); }
static void run(dem_world *w, double t, int features) {
    const dem_status status = dem_run(w, t, features);
    if (status != DEM_OK) fail_msg("%s, particle %lu, step %ld", dem_status_text(status), (unsigned long)w->failed_id, (long)w->step);
}

/* ---- what decays comes to rest ---- */

static int is_subnormal(double v) { return v != 0.0 && fabs(v) < DBL_MIN; }
static int subnormals_of(dem_vec v) { return is_subnormal(v.x) + is_subnormal(v.y) + is_subnormal(v.z); }

/* In speeds, spins and histories, and in their squares. */
static int count_subnormals(const dem_world *w) {
    int n = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_vec v = dem_velocity(w, i), s = w->particle[i].spin;
        n += subnormals_of(v) + subnormals_of(s) + subnormals_of(w->particle[i].a) + subnormals_of(w->spin_rate[i]);
        n += subnormals_of(v3(v.x * v.x, v.y * v.y, v.z * v.z)) + subnormals_of(v3(s.x * s.x, s.y * s.y, s.z * s.z));
    }
    for (ptrdiff_t k = 0; k < dem_contact_count(w); k++) {
        const dem_contact_info c = dem_get_contact(w, k);
        for (int a = 0; a < DEM_STATE_MAX; a++) n += is_subnormal(c.state[a]) + is_subnormal(c.state[a] * c.state[a]);
    }
    for (int k = 0; k < w->walls; k++) n += is_subnormal(w->wall[k].rate) + subnormals_of(w->wall[k].velocity);
    return n;
}

/* Balls of several kinds on a plane, 3 ms being more than a thousand steps of decay. */
static void on_plane(dem_world *w, double rolling, double tangential_damping, double restitution) {
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 2500.0, 1e8, 0.2);
    dem_pair_def *p = dem_pair(&def, m, m);
    p->rolling = rolling, p->friction = 0.5, p->restitution = restitution, p->tangential_damping = tangential_damping, p->stiffness = 1e4;
    def.dt = 5e-6;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
    dem_add_plane(w, m, v3(0, 0, 0), v3(0, 0, 1));
    for (int i = 0; i < 12; i++) {
        const double c[3] = {0.0058 * (i / 2), 0.02 * (i % 2), 0.003}, d = 0.006; /* six in a row overlap: a chain */
        assert_int_equal(dem_add_spheres(w, 1, c, &d, m, 0), DEM_OK);
        dem_set_motion(w, i, v3(0.05, 0.01 * i, 0), v3(-1.0 * i, 0.05 / 0.003, i % 3 ? 0.0 : 5.0));
    }
}
static void test_no_subnormal_numbers(void **state) {
    (void)state;
    for (int k = 0; k < 16; k++) {
        const int features = (k & 1 ? DEM_HERTZ : DEM_LINEAR) | DEM_FRICTION | DEM_ROLLING | (k & 2 ? DEM_ENERGY : 0);
        dem_world w;
        int n = 0;
        on_plane(&w, 3e-4, k & 4 ? 0.5 : 0.0, k & 8 ? 0.2 : 0.9);
        for (int q = 0; q < 60; q++) {
            run(&w, 0.01, features);
            n += count_subnormals(&w);
        }
        assert_int_equal(n, 0);
        dem_free(&w);
    }
}

/* A rotor and a piston whose dampers stop them, and the ball that they carry; a motion too small to be one. */
static void test_no_subnormal_walls(void **state) {
    (void)state;
    dem_world w;
    on_plane(&w, 3e-4, 0.5, 0.2);
    const int rotor = dem_add_plane(&w, 0, v3(0, 0, 1), v3(0, 0, -1)), piston = dem_add_plane(&w, 0, v3(0, 0, 2), v3(0, 0, -1));
    assert_int_equal(dem_rotate(&w, rotor, v3(0, 0, 1), v3(0, 0, 1), 3.0), DEM_OK);
    assert_int_equal(dem_control_torque(&w, rotor, v3(0, 0, 1), v3(0, 0, 1), 1e-6, 0.0, 1e-3), DEM_OK);
    assert_int_equal(dem_move(&w, piston, v3(0, 0, 0.01)), DEM_OK);
    assert_int_equal(dem_control_force(&w, piston, v3(0, 0, 1), 1e-3, 0.0, 2.0), DEM_OK);
    for (int q = 0; q < 200; q++) {
        run(&w, 0.01, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING);
        assert_int_equal(count_subnormals(&w), 0);
    }
    near_absolute(w.wall[rotor].rate, 0.0, 1e-90, "rotor");
    near_absolute(w.wall[piston].rate, 0.0, 1e-90, "piston");
    assert_int_equal(dem_set_motion(&w, 0, v3(1e-310, 0, 0), v3(0, 1e-300, 0)), DEM_OK);
    assert_int_equal(count_subnormals(&w), 0);
    dem_free(&w);
}

/* A ball below its rolling limit: the default law, which resists in proportion to a slow spin, creeps at 5 g sin dt; contact_epsd, which
   has a spring, stands still (test_contact_laws). */
static void test_creep_of_the_default_law(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        const double dt = 8e-6 / (1 << k), slope = 0.05, radius = 0.003;
        dem_def def = dem_default_def();
        const int m = dem_add_material(&def, 2500.0, 1e8, 0.2);
        dem_world w;
        dem_pair_def *p = dem_pair(&def, m, m);
        p->rolling = 3e-4, p->friction = 0.5, p->restitution = 0.3, p->tangential_damping = 1.0, p->stiffness = 1e4;
        def.dt = dt, def.gravity = v3(9.81 * slope, 0, -9.81);
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        const double c[3] = {0, 0, radius}, d = 2.0 * radius;
        dem_add_plane(&w, m, v3(0, 0, 0), v3(0, 0, 1));
        dem_add_spheres(&w, 1, c, &d, m, 0);
        run(&w, 0.2, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING);
        near_relative(dem_velocity(&w, 0).x, 5.0 * 9.81 * slope * dt, 1e-2, "creep");
        dem_free(&w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_subnormal_numbers),
        cmocka_unit_test(test_no_subnormal_walls),
        cmocka_unit_test(test_creep_of_the_default_law),
    };
    return cmocka_run_group_tests_name("faults", tests, NULL, NULL);
}
