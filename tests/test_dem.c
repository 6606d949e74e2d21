/* dem.h: laws, single particles, walls and screens, lists, skipping, saves, hostile input. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include "near.h"

#include <stdio.h>
#include <stdlib.h>

#include "dem_scenes.h"
#include "failing_allocator.h"

static void near_vec(dem_vec got, dem_vec wanted, double tolerance, const char *what) {
    near_absolute(got.x, wanted.x, tolerance, what), near_absolute(got.y, wanted.y, tolerance, what),
        near_absolute(got.z, wanted.z, tolerance, what);
}
static dem_vec v3(double x, double y, double z) { return dem_vec3(x, y, z); }
static const dem_vec zero = {0.0, 0.0, 0.0}, up = {0.0, 0.0, 1.0};
static const double diameter = 5e-3, radius = 2.5e-3, nan_ = (double)NAN, inf = (double)INFINITY;
static double mass_of(double d) { return RIDDLE_PI / 6.0 * d * d * d * 2534.1; }

/* A world of one material, whose pair parameters the caller may edit before starting. */
static dem_def one_material(double e, double friction, double rolling) {
    dem_def def = dem_default_def();
    int m = dem_add_material(&def, 2534.1, 1e8, 0.2);
    dem_pair_def *p = dem_pair(&def, m, m);
    def.dt = 4e-6;
    p->restitution = e, p->friction = friction, p->rolling = rolling;
    return def;
}
static void start(dem_world *w, const dem_def *def) { assert_int_equal(dem_init(w, def, NULL), DEM_OK); }
static void add(dem_world *w, dem_vec at, double d) {
    assert_int_equal(dem_add_spheres(w, 1, &at.x, &d, 0, 0), DEM_OK);
}
static void move(dem_world *w, ptrdiff_t i, dem_vec v, dem_vec spin) {
    assert_int_equal(dem_set_motion(w, i, v, spin), DEM_OK);
}
static void run(dem_world *w, double t, int features) {
    dem_status status = dem_run(w, t, features);
    if (status != DEM_OK)
        fail_msg("%s, particle %lu, step %ld", dem_status_text(status), (unsigned long)w->failed_id, (long)w->step);
}

/* ---- laws ---- */

static void test_restitution_laws(void **state) {
    (void)state;
    const double m = 8.18e-5, k = 1e5;
    near_relative(dem_damping_ratio(0.7808, DEM_NAIVE), 7.8518240750470514e-2, 1e-12, "zeta N1, 0.7808");
    near_relative(dem_damping_ratio(0.7808, DEM_CLIPPED), 8.2867177921014822e-2, 1e-12, "zeta N2, 0.7808");
    near_relative(dem_contact_time(k, m, dem_damping_ratio(0.7808, DEM_CLIPPED), DEM_CLIPPED), 8.5399910831154636e-5,
                  1e-12, "t_c, 0.7808");
    near_relative(dem_damping_ratio(0.4351, DEM_NAIVE), 0.25605971869412566, 1e-12, "zeta N1, 0.4351");
    near_relative(2.0 * dem_damping_ratio(0.4351, DEM_CLIPPED) * sqrt(k * m), 1.8075348743475626, 1e-12,
                  "gamma N2, 0.4351");
    near_relative(dem_contact_time(k, m, dem_damping_ratio(0.4351, DEM_CLIPPED), DEM_CLIPPED), 7.5320565049314573e-5,
                  1e-12, "t_c, 0.4351");
    static const double table[5][4] = {{0.9, 0.0335184491, 0.0342652041, 0.902026},
                                       {0.7808, 0.0785182408, 0.0828671779, 0.790527},
                                       {0.5, 0.2154537620, 0.2552756376, 0.550283},
                                       {0.4351, 0.2560597187, 0.3159948741, 0.499077},
                                       {0.2, 0.4559498108, 0.7312469268, 0.324863}};
    for (int n = 0; n < 5; n++) {
        near_absolute(dem_damping_ratio(table[n][0], DEM_NAIVE), table[n][1], 5.1e-11, "zeta N1");
        near_absolute(dem_damping_ratio(table[n][0], DEM_CLIPPED), table[n][2], 5.1e-11, "zeta N2");
        near_absolute(dem_restitution_of(table[n][1], DEM_CLIPPED), table[n][3], 5.1e-7, "e of N1 with a clipped law");
    }
    for (double e = 1e-9; e <= 1.0; e = e < 0.9 ? e * 1.07 : e + 1e-3) {
        near_relative(dem_restitution_of(dem_damping_ratio(e, DEM_NAIVE), DEM_NAIVE), e,
                      1e-13 * (1.0 - log(e) * log(e) * log(e)) + 2e-12, "naive there and back");
        near_relative(dem_restitution_of(dem_damping_ratio(e, DEM_CLIPPED), DEM_CLIPPED), e, 1e-12,
                      "clipped there and back");
    }
    assert_true(dem_damping_ratio(1.0, DEM_NAIVE) == 0.0 && dem_damping_ratio(1.0, DEM_CLIPPED) == 0.0);
    near_relative(dem_restitution_of(1.0, DEM_CLIPPED), exp(-2.0), 1e-14, "e(1)");
    for (double d = -2e-3; d <= 2e-3; d += 1e-4) { /* across the joint of series and closed form */
        double zeta = 1.0 + d, g = fabs(d) < 1e-12 ? 1.0
                                   : d < 0.0       ? acos(zeta) / sqrt(1.0 - zeta * zeta)
                                                   : log(zeta + sqrt(zeta * zeta - 1.0)) / sqrt(zeta * zeta - 1.0);
        near_relative(dem_restitution_of(zeta, DEM_CLIPPED), exp(-2.0 * zeta * g), 1e-11, "near critical damping");
    }
    near_relative(dem_restitution_of(50.0, DEM_CLIPPED), 1.0 / (4.0 * 2500.0), 2e-3, "e -> 1/(4 zeta^2)");
    near_relative(dem_contact_time(k, m, 0.0, DEM_NAIVE), RIDDLE_PI * sqrt(m / k), 1e-15, "elastic t_c");
    /* Hertz: 2 sqrt(pi) Gamma(2/5)/(5 Gamma(9/10)) (15 m/(16 E sqrt(R)))^(2/5) v^(-1/5) * 2 */
    near_relative(dem_hertz_contact_time(2e9, 3e-3, 1e-4, 0.7),
                  2.9432751753955 * pow(15.0 * 1e-4 / (16.0 * 2e9 * sqrt(3e-3)), 0.4) * pow(0.7, -0.2), 1e-12,
                  "Hertz t_c");
}

static void test_laws_outside_their_domain(void **state) {
    (void)state;
    static const double bad_e[] = {0.0, -0.5, 1.0000001, 2.0, (double)NAN, (double)INFINITY, -(double)INFINITY};
    for (size_t k = 0; k < sizeof bad_e / sizeof *bad_e; k++) {
        assert_true(isnan(dem_damping_ratio(bad_e[k], DEM_NAIVE)));
        assert_true(isnan(dem_damping_ratio(bad_e[k], DEM_CLIPPED)));
    }
    static const double bad_zeta[] = {-1e-9, (double)NAN, (double)INFINITY};
    for (size_t k = 0; k < sizeof bad_zeta / sizeof *bad_zeta; k++) {
        assert_true(isnan(dem_restitution_of(bad_zeta[k], DEM_NAIVE)) &&
                    isnan(dem_restitution_of(bad_zeta[k], DEM_CLIPPED)));
        assert_true(isnan(dem_contact_time(1.0, 1.0, bad_zeta[k], DEM_CLIPPED)));
    }
    assert_true(isnan(dem_restitution_of(1.0, DEM_NAIVE)) && isnan(dem_contact_time(1.0, 1.0, 1.0, DEM_NAIVE)));
    static const double bad[] = {0.0, -1.0, (double)NAN};
    for (int k = 0; k < 3; k++) {
        assert_true(isnan(dem_contact_time(bad[k], 1.0, 0.1, DEM_NAIVE)) &&
                    isnan(dem_contact_time(1.0, bad[k], 0.1, DEM_CLIPPED)));
        assert_true(isnan(dem_hertz_contact_time(bad[k], 1, 1, 1)) && isnan(dem_hertz_contact_time(1, bad[k], 1, 1)));
        assert_true(isnan(dem_hertz_contact_time(1, 1, bad[k], 1)) && isnan(dem_hertz_contact_time(1, 1, 1, bad[k])));
    }
    assert_true(dem_damping_ratio(1e-300, DEM_CLIPPED) > 1e100 && dem_restitution_of(1e300, DEM_CLIPPED) >= 0.0);
}

static void test_advice(void **state) {
    (void)state;
    dem_def def = scene_def(1e-6);
    dem_world w;
    start(&w, &def);
    dem_advice none = dem_advise(&w, DEM_LINEAR, 1.0);
    assert_true(none.contact == inf && none.rayleigh == inf && none.dashpot == inf);
    add(&w, zero, 10e-3), add(&w, v3(1, 0, 0), 5e-3), add(&w, v3(2, 0, 0), 7e-3);
    dem_advice pair = dem_advise(&w, DEM_LINEAR, 1.0);
    double m = mass_of(5e-3);
    near_relative(pair.contact, dem_contact_time(1e5, 0.5 * m, dem_damping_ratio(0.7808, DEM_CLIPPED), DEM_CLIPPED),
                  1e-13, "the smallest pair's t_c");
    near_relative(pair.dashpot, 0.5 * m / (2.0 * dem_damping_ratio(0.7808, DEM_CLIPPED) * sqrt(1e5 * 0.5 * m)), 1e-13,
                  "its dashpot");
    near_relative(pair.rayleigh, RIDDLE_PI * 2.5e-3 * sqrt(2534.1 / (5e7 / 2.4)) / (0.1631 * 0.2 + 0.8766), 1e-13,
                  "Rayleigh");
    near_relative(pair.advised, pair.contact / 20.0, 1e-13, "advised");
    assert_true(dem_add_plane(&w, 1, zero, up) == 0);
    dem_advice wall = dem_advise(&w, DEM_LINEAR, 1.0);
    near_relative(wall.contact, pair.contact, 1e-13, "the wall's contact is longer");
    near_relative(wall.dashpot, m / (2.0 * dem_damping_ratio(0.4351, DEM_NAIVE) * sqrt(1e5 * m)), 1e-13,
                  "but its dashpot is stronger");
    dem_advice slow = dem_advise(&w, DEM_HERTZ, 0.1), fast = dem_advise(&w, DEM_HERTZ, 10.0);
    assert_true(slow.contact > fast.contact && fast.advised <= fast.contact / 20.0 &&
                slow.advised <= 0.2 * slow.rayleigh * (1 + 1e-12));
    near_relative(slow.contact / fast.contact, pow(100.0, 0.2), 1e-12, "t_c ~ v^(-1/5)");
    assert_true(isnan(dem_advise(&w, DEM_HERTZ, nan_).advised) && isnan(dem_advise(&w, DEM_HERTZ, 0.0).advised) &&
                isnan(dem_advise(NULL, DEM_LINEAR, 1.0).advised));
    dem_free(&w);
}

/* ---- one particle ---- */

static void test_free_flight(void **state) {
    (void)state;
    dem_def def = one_material(0.8, 0.3, 0.0);
    for (int loaded = 0; loaded < 2; loaded++) {
        dem_world w;
        dem_vec x = v3(0.1, -0.2, 3.0), v = v3(0.3, 0.7, 2.0), s = v3(1, 2, 3), force = v3(1e-3, -2e-3, 5e-4),
                torque = v3(1e-6, 0, -2e-6);
        start(&w, &def);
        add(&w, x, diameter);
        move(&w, 0, v, s);
        if (loaded) assert_int_equal(dem_set_load(&w, 0, force, torque), DEM_OK);
        double m = loaded ? 1.0 / dem_mass(&w, 0) : 0.0,
               turn = loaded ? 2.5 / (dem_mass(&w, 0) * radius * radius) : 0.0;
        dem_vec a = v3(m * force.x, m * force.y, m * force.z - 9.81);
        for (int k = 1; k <= 25; k++) {
            run(&w, 0.01, DEM_LINEAR);
            double t = w.time;
            near_relative(t, 0.01 * k, 1e-12, "time");
            near_vec(
                dem_position(&w, 0),
                v3(x.x + t * (v.x + 0.5 * t * a.x), x.y + t * (v.y + 0.5 * t * a.y), x.z + t * (v.z + 0.5 * t * a.z)),
                loaded ? 1e-11 : 2e-15, "parabola");
            near_vec(dem_velocity(&w, 0), v3(v.x + t * a.x, v.y + t * a.y, v.z + t * a.z), loaded ? 1e-11 : 2e-15,
                     "velocity");
            near_relative(dem_spin(&w, 0).x, s.x + t * turn * torque.x, 1e-11, "spin"),
                near_relative(dem_spin(&w, 0).z, s.z + t * turn * torque.z, 1e-11, "spin");
        }
        assert_int_equal(w.contact_steps, 0);
        dem_free(&w);
    }
}

/* A sphere on a plane, in static equilibrium with gravity (angle of the plane against the horizontal by
   tilting gravity). */
static void on_plane(dem_world *w, const dem_def *def, double angle) {
    dem_def d = *def;
    d.gravity = v3(9.81 * sin(angle), 0, -9.81 * cos(angle));
    start(w, &d);
    assert_int_equal(dem_add_plane(w, 0, zero, up), 0);
    add(w, v3(0, 0, radius - mass_of(diameter) * 9.81 * cos(angle) / 1e5), diameter);
}

static void test_bowled_ball(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.6, 0.3, 0.0);
    const int features = DEM_LINEAR | DEM_FRICTION;
    on_plane(&w, &def, 0.0);
    move(&w, 0, v3(1, 0, 0), zero);
    double t = 2.0 / (7.0 * 0.3 * 9.81); /* rolls from here */
    run(&w, 0.5 * t, features);
    near_relative(dem_velocity(&w, 0).x, 1.0 - 0.3 * 9.81 * w.time, 1e-4, "sliding: v0 - mu g t");
    near_relative(dem_spin(&w, 0).y * radius, 2.5 * 0.3 * 9.81 * w.time, 1e-4, "sliding: spin");
    run(&w, 1.0 * t, features);
    near_relative(dem_velocity(&w, 0).x, 5.0 / 7.0, 2e-4, "rolls at 5/7 v0");
    double v = dem_velocity(&w, 0).x;
    run(&w, 0.2, features);
    near_relative(dem_velocity(&w, 0).x, v, 1e-3, "rolling goes on");
    near_relative(dem_spin(&w, 0).y * radius, dem_velocity(&w, 0).x, 1e-3, "without slip");
    assert_true(dem_position(&w, 0).y == 0.0 && dem_velocity(&w, 0).y == 0.0);
    near_absolute(dem_position(&w, 0).z, radius, 1e-7, "on the plane");
    dem_free(&w);
}

static void test_incline(void **state) {
    (void)state;
    for (int hertz = 0; hertz < 2; hertz++) {
        const int features = (hertz ? DEM_HERTZ : DEM_LINEAR) | DEM_FRICTION;
        static const double angle[4] = {0.2, 0.6, 0.9, 1.2}; /* rolls without slip while tan(angle) < 7/2 mu = 0.875 */
        for (int k = 0; k < 4; k++) {
            dem_world w;
            dem_def def = one_material(0.5, 0.25, 0.0);
            def.dt = hertz ? 1e-6 : 4e-6;
            dem_pair(&def, 0, 0)->tangential_damping = 1.0;
            on_plane(&w, &def, angle[k]);
            run(&w, 0.1, features);
            int sticks = tan(angle[k]) < 3.5 * 0.25;
            double a = sticks ? 5.0 / 7.0 * 9.81 * sin(angle[k]) : 9.81 * (sin(angle[k]) - 0.25 * cos(angle[k]));
            near_relative(dem_velocity(&w, 0).x, a * w.time, 0.01, sticks ? "rolls down" : "slides down");
            double rolls = sticks ? a / radius : 2.5 * 0.25 * 9.81 * cos(angle[k]) / radius;
            near_relative(dem_spin(&w, 0).y, rolls * w.time, 0.01, "spin");
            dem_free(&w);
        }
    }
}

static void test_rolling_resistance(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.6, 0.5, 1e-4);
    on_plane(&w, &def, 0.0);
    const int features = DEM_LINEAR | DEM_FRICTION | DEM_ROLLING;
    double v = 0.1, a = 5.0 / 7.0 * 9.81 * 1e-4 / radius;
    move(&w, 0, v3(v, 0, 0), v3(0, v / radius, 0));
    run(&w, 0.2, features);
    near_relative(dem_velocity(&w, 0).x, v - a * w.time, 5e-3, "5/7 g mu_roll/r");
    run(&w, v / a - w.time + 0.1, features);
    near_absolute(dem_velocity(&w, 0).x, 0.0, 1e-4, "at rest");
    dem_vec at = dem_position(&w, 0);
    near_relative(at.x, 0.5 * v * v / a, 5e-3, "its way");
    run(&w, 0.1, features);
    near_absolute(dem_position(&w, 0).x, at.x, 2e-6, "stays");
    dem_free(&w);
}

/* The plane turns about an axis through the sphere's centre, and the load with it: a stuck contact, pulled sideways,
   goes round with its tangential spring, whose length stays and whose direction follows. */
/* A hit that slides and sticks: what the dashpot does to the spring does not depend on the number of steps. Limits
   from t_c/5120. */
static void test_tangential_dashpot(void **state) {
    (void)state;
    const double limit[2] = {1.053, 1.039}, sliding[2] = {0.2252, 0.2079}, steps[2] = {20.0, 80.0};
    for (int k = 0; k < 4; k++) {
        const int hertz = k / 2, features = (hertz ? DEM_HERTZ : DEM_LINEAR) | DEM_FRICTION | DEM_ENERGY;
        const double mass = mass_of(diameter), start_energy = 0.5 * mass * 3.25;
        double velocity = 0.0, loss = 0.0, error = 0.0; /* means */
        dem_def def = one_material(0.5, 0.3, 0.0);
        dem_pair(&def, 0, 0)->tangential_damping = 1.0;
        def.material[0].poisson_ratio = 0.3;
        const double contact = hertz ? dem_hertz_contact_time(1e8 / 1.82, radius, mass, 1.0)
                                     : dem_contact_time(1e5, mass, dem_damping_ratio(0.5, DEM_CLIPPED), DEM_CLIPPED);
        def.gravity = zero, def.dt = contact / steps[k % 2];
        /* of the first step: what they scatter by is half of what they err */
        for (int phase = 0; phase < 20; phase++) {
            dem_world w;
            start(&w, &def);
            dem_add_plane(&w, 0, zero, up);
            add(&w, v3(0, 0, 1.001 * radius + 0.05 * phase * def.dt), diameter);
            move(&w, 0, v3(1.5, 0, -1), zero);
            run(&w, 1e-3, features);
            velocity += 0.05 * dem_velocity(&w, 0).x;
            loss += 0.05 * dem_energy(&w).sliding_loss / start_energy;
            error += 0.05 * dem_energy(&w).error / start_energy;
            dem_free(&w);
        }
        near_absolute(velocity, limit[hertz], 2.5e-3, "tangential velocity");
        near_absolute(loss, sliding[hertz], 0.15 / steps[k % 2], "sliding loss");
        near_absolute(error, 0.0, (hertz ? 1.2 : 0.15) / (steps[k % 2] * steps[k % 2]), "ledger");
    }

    dem_world w; /* the dashpot alone: it stores nothing that would act after sliding */
    dem_def def = one_material(0.5, 0.3, 0.0);
    dem_pair(&def, 0, 0)->tangential_damping = 1.0;
    dem_pair(&def, 0, 0)->tangential_ratio = 0.0;
    on_plane(&w, &def, 0.0);
    move(&w, 0, v3(0.5, 0, 0), zero);
    run(&w, 0.2, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY);
    near_relative(dem_velocity(&w, 0).x, 0.5 * 5.0 / 7.0, 1e-3, "rolling");
    near_absolute(dem_get_contact(&w, 0).force.x, 0.0, 1e-6, "force on what rolls");
    near_absolute(dem_energy(&w).error, 0.0, 1e-3 * mass_of(diameter) * 0.125, "ledger");
    dem_free(&w);
}

/* What is told of a contact that has begun in the last step is its force, not what the step was mended by. */
static void test_force_of_a_new_contact(void **state) {
    (void)state;
    for (int features = DEM_LINEAR; features <= (DEM_LINEAR | DEM_FRICTION); features += DEM_FRICTION) {
        dem_world w;
        dem_def def = one_material(1.0, 0.3, 0.0);
        def.gravity = zero, def.dt = 1e-6;
        start(&w, &def);
        dem_add_plane(&w, 0, zero, up);
        add(&w, v3(0, 0, radius + 0.3e-6), diameter);
        move(&w, 0, v3(0, 0, -1), zero);
        run(&w, def.dt, features);
        assert_int_equal(dem_contact_count(&w), 1);
        near_relative(dem_get_contact(&w, 0).force.z, 1e5 * (radius - dem_position(&w, 0).z), 1e-9, "force");
        near_relative(radius - dem_position(&w, 0).z, 0.7e-6, 1e-3, "overlap");
        dem_free(&w);
    }
}

static void test_history_turns_with_the_contact(void **state) {
    (void)state;
    for (int hertz = 0; hertz < 2; hertz++) {
        dem_world w;
        dem_def def = one_material(0.3, 0.6, 0.0);
        const int features = (hertz ? DEM_HERTZ : DEM_LINEAR) | DEM_FRICTION;
        const double spin = 60.0, push = 0.5, pull = 0.15;
        double length0 = 0.0, worst = 0.0, off = 0.0;
        dem_pair(&def, 0, 0)->tangential_damping = 1.0;
        def.gravity = zero;
        def.dt = 5e-6;
        start(&w, &def);
        int plane = dem_add_plane(&w, 0, v3(0, 0, -radius + 1e-6), up);
        assert_int_equal(dem_rotate(&w, plane, zero, v3(0, 1, 0), spin), DEM_OK);
        add(&w, zero, diameter);
        move(&w, 0, zero, v3(0, spin, 0));
        int turns = 0, n = (int)(2.0 * RIDDLE_PI / spin / def.dt);
        for (int k = 0; k < 4 * n; k++) {
            double angle = spin * (w.time + 0.5 * def.dt), c = cos(angle), s = sin(angle),
                   ramp = k < n / 2 ? k / (0.5 * n) : 1.0;
            double arm = radius + (dem_contact_count(&w) ? dem_get_contact(&w, 0).gap : 0.0);
            /* axes of the plane: e1 = (c, 0, -s), n = (s, 0, c); a soft spring along e1, or it would roll off by
               centrifugal force */
            dem_vec x = dem_position(&w, 0), v = dem_velocity(&w, 0);
            double side = ramp * pull - 20.0 * (x.x * c - x.z * s) - 0.1 * (v.x * c - v.z * s);
            assert_int_equal(
                dem_set_load(&w, 0, v3(side * c - push * s, 0, -side * s - push * c), v3(0, -ramp * pull * arm, 0)),
                DEM_OK);
            run(&w, def.dt, features);
            if (k < 2 * n || k % 100) continue;
            assert_int_equal(dem_contact_count(&w), 1);
            dem_contact_info q = dem_get_contact(&w, 0);
            double at = spin * w.time, e1 = q.state[0] * cos(at) - q.state[2] * sin(at),
                   out = q.state[0] * sin(at) + q.state[2] * cos(at);
            double length = sqrt(q.state[0] * q.state[0] + q.state[1] * q.state[1] + q.state[2] * q.state[2]);
            if (length0 == 0.0) length0 = length;
            worst = fmax(worst, fabs(length / length0 - 1.0)),
            off = fmax(off, sqrt(out * out + q.state[1] * q.state[1]) / length);
            near_relative(e1, length, 1e-3, "along the pull");
            turns++;
        }
        near_relative(length0, hertz ? pull : pull / (1e5 * 2.0 / 7.0), 0.01, "pull over stiffness");
        assert_true(turns > 100 && worst < 2e-3 && off < 2e-3);
        dem_free(&w);
    }
}

/* A law of one's own: linear spring and dashpot, friction as shipped, and a constant attraction. */
static double prepare_sticky(const dem_birth *b, double *constants) {
    constants[DEM_LINEAR_CONSTANTS] = 2e-2; /* [N] */
    return dem_prepare_linear(b, constants);
}
DEM_INLINE void force_sticky(const dem_contact *c, double *state, dem_response *r) {
    dem_force_linear_friction(c, state, r);
    /* the pull holds the pair together; friction counts the contact's part alone */
    r->normal -= c->constants[DEM_LINEAR_CONSTANTS];
}
static const dem_law law_sticky = {"linear with attraction", 1, 3, 3, 1, 9, prepare_sticky, force_sticky, NULL, NULL};
DEM_KERNEL(kernel_sticky, law_sticky, DEM_LINEAR | DEM_FRICTION)

static void test_rigid_rotation_is_no_slip(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.7, 0.5, 0.0);
    double spin = 20.0;
    def.gravity = zero;
    start(&w, &def);
    /* Rests at 0.02 N / 1e5 N/m. */
    add(&w, v3(0.5 * diameter, 0, 0), diameter), add(&w, v3(-0.5 * diameter + 2e-7, 0, 0), diameter);
    dem_vec axis = v3(0, 0.6, 0.8);
    for (ptrdiff_t i = 0; i < 2; i++) {
        dem_vec x = dem_position(&w, i);
        move(&w, i,
             v3(spin * (axis.y * x.z - axis.z * x.y), spin * (axis.z * x.x - axis.x * x.z),
                spin * (axis.x * x.y - axis.y * x.x)),
             v3(0, spin * axis.y, spin * axis.z));
    }
    double t = 3.0 * 2.0 * RIDDLE_PI / spin; /* three turns */
    assert_int_equal(dem_run_law(&w, t, &kernel_sticky), DEM_OK);
    assert_int_equal(dem_contact_count(&w), 1);
    dem_contact_info c = dem_get_contact(&w, 0);
    near_absolute(sqrt(c.state[0] * c.state[0] + c.state[1] * c.state[1] + c.state[2] * c.state[2]), 0.0, 1e-9,
                  "history of a rigid rotation");
    near_relative(dem_spin(&w, 0).z, spin * 0.8, 1e-4, "spin");
    near_relative(dem_spin(&w, 1).y, spin * 0.6, 1e-4, "spin");
    dem_free(&w);
}

static void test_binary_collisions_keep_momentum(void **state) {
    (void)state;
    scene_random r = {3};
    int hits = 0;
    for (int k = 0; k < 60; k++) {
        dem_world w;
        dem_def def = one_material(0.7, k % 3 * 0.3, 0.0);
        int features = k % 3 ? DEM_LINEAR | DEM_FRICTION : DEM_LINEAR;
        double before[3], after[3], scale = 0.0;
        def.gravity = zero;
        start(&w, &def);
        add(&w, zero, 5e-3), add(&w, v3(scene_between(&r, -4e-3, 4e-3), 0, 7e-3), 7e-3);
        move(&w, 1, v3(0.2, 0.1, -1), scene_vector(&r, 50.0)),
            move(&w, 0, scene_vector(&r, 0.3), scene_vector(&r, 50.0));
        for (int n = 0; n < 2; n++) {
            double *l = n ? after : before;
            l[0] = l[1] = l[2] = 0.0;
            for (ptrdiff_t i = 0; i < 2; i++) {
                dem_vec x = dem_position(&w, i), v = dem_velocity(&w, i);
                double inertia = 0.4 * dem_mass(&w, i) * dem_radius(&w, i) * dem_radius(&w, i);
                l[0] += dem_mass(&w, i) * (x.y * v.z - x.z * v.y) + inertia * dem_spin(&w, i).x;
                l[1] += dem_mass(&w, i) * (x.z * v.x - x.x * v.z) + inertia * dem_spin(&w, i).y;
                l[2] += dem_mass(&w, i) * (x.x * v.y - x.y * v.x) + inertia * dem_spin(&w, i).z;
                scale += dem_mass(&w, i) * 7e-3;
            }
            if (!n) run(&w, 0.005, features);
        }
        assert_int_equal(dem_contact_count(&w), 0);
        hits += w.contact_steps > 3;
        for (int a = 0; a < 3; a++)
            near_absolute(after[a], before[a], (k % 3 ? 1e-7 : 1e-14) * scale, "angular momentum");
        dem_free(&w);
    }
    assert_true(hits > 30);
}

/* ---- walls ---- */

static void test_wall_is_an_infinite_mass(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        dem_vec v[2], s[2];
        for (int wall = 0; wall < 2; wall++) {
            dem_world w;
            dem_def def = one_material(0.7, 0.2, 0.0);
            int heavy = dem_add_material(&def, 2534.1e15, 1e8, 0.2);
            *dem_pair(&def, 0, heavy) = *dem_pair(&def, 0, 0);
            def.gravity = zero;
            start(&w, &def);
            add(&w, v3(0, 0, radius + 1e-5), diameter);
            move(&w, 0, v3(0.3, 0.1, -0.5), v3(5, 6, 7));
            if (wall) assert_int_equal(dem_add_plane(&w, heavy, zero, up), 0);
            else {
                double c[3] = {0, 0, -1e4 * radius}, d = 2e4 * radius;
                assert_int_equal(dem_add_spheres(&w, 1, c, &d, heavy, 0), DEM_OK);
            }
            run(&w, 4e-4, k ? DEM_LINEAR | DEM_FRICTION : DEM_LINEAR);
            v[wall] = dem_velocity(&w, 0), s[wall] = v3(dem_spin(&w, 0).x, dem_spin(&w, 0).y, dem_spin(&w, 0).z);
            assert_true(v[wall].z > 0.3);
            dem_free(&w);
        }
        near_vec(v[0], v[1], k ? 5e-4 : 1e-6, "velocity after");
        near_vec(s[0], s[1], k ? 0.9 : 1e-12, "spin after"); /* of 143; the arms differ by the overlap, 0.8 % */
    }
}

static void test_cylinder(void **state) {
    (void)state;
    const double big = 0.05, g = 9.81;
    /* a sphere swings in the trough; axis along y, slightly off its length 1 */
    for (int friction = 0; friction < 2; friction++) {
        dem_world w;
        dem_def def = one_material(0.4, 0.8, 0.0);
        dem_pair(&def, 0, 0)->tangential_damping = 0.5;
        start(&w, &def);
        assert_int_equal(dem_add_cylinder(&w, 0, v3(0, 3, 0), v3(0, 2.5, 0), big, 1), 0);
        double angle = 0.05, out = big - radius, period = 2.0 * RIDDLE_PI * sqrt((friction ? 1.4 : 1.0) * out / g),
               last = 0.0, crossed[3];
        int crossings = 0;
        add(&w, v3(out * sin(angle), 0, -out * cos(angle)), diameter);
        for (int k = 0; k < 100000 && crossings < 3; k++) {
            run(&w, 10.0 * def.dt, friction ? DEM_LINEAR | DEM_FRICTION : DEM_LINEAR);
            double x = dem_position(&w, 0).x;
            if (k > 0 && last > 0.0 && x <= 0.0) crossed[crossings++] = w.time - 10.0 * def.dt * x / (x - last);
            last = x;
        }
        near_relative(0.5 * (crossed[2] - crossed[0]), period * (1.0 + angle * angle / 16.0), 3e-3,
                      "period in the trough");
        dem_free(&w);
    }
    dem_world w; /* outside: falls on the top, and rests there for a moment at its static overlap */
    dem_def def = one_material(0.05, 0.8, 0.0);
    start(&w, &def);
    assert_int_equal(dem_add_cylinder(&w, 0, v3(0, -1, 0), v3(0, 1, 0), big, 0), 0);
    add(&w, v3(0, 0, big + radius + 1e-5), diameter);
    run(&w, 0.05, DEM_LINEAR | DEM_FRICTION);
    near_absolute(dem_position(&w, 0).z, big + radius - mass_of(diameter) * g / 1e5, 1e-10, "static overlap");
    near_absolute(w.wall[0].force.z, -mass_of(diameter) * g, 1e-5, "its weight");
    dem_free(&w);
}

static void test_wall_carries_weight(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.3, 0.3, 0.0);
    double weight = 0.0;
    start(&w, &def);
    int plane = dem_add_plane(&w, 0, v3(0.2, 0.1, 0), v3(0, 0, 7)), deck;
    for (int k = 0; k < 5; k++)
        add(&w, v3(0.01 * k, 0, (4 + k) * 0.5e-3), (4 + k) * 1e-3), weight += mass_of((4 + k) * 1e-3) * 9.81;
    run(&w, 0.15, DEM_LINEAR | DEM_FRICTION);
    near_relative(-w.wall[plane].force.z, weight, 1e-6, "weight on a plane");
    near_absolute(w.wall[plane].impulse.z, -weight * w.time, 2e-3 * weight * w.time, "its impulse");
    double torque = 0.0;
    /* y-part of r x F, F down */
    for (int k = 0; k < 5; k++) torque += mass_of((4 + k) * 1e-3) * 9.81 * (dem_position(&w, k).x - 0.2);
    near_relative(w.wall[plane].torque.y, torque, 1e-6, "torque about its origin");
    dem_free(&w);
    for (int profile = 0; profile < 2; profile++) { /* on four bars */
        dem_screen s = dem_default_screen();
        s.profile = profile ? DEM_SEMICIRCLE : DEM_ROUND;
        start(&w, &def);
        deck = dem_add_screen(&w, 0, &s);
        add(&w, v3(0.0, 0.0, 3.4e-3), 10e-3);
        run(&w, 0.2, DEM_LINEAR | DEM_FRICTION);
        assert_int_equal(dem_contact_count(&w), 4);
        near_relative(-w.wall[deck].force.z, mass_of(10e-3) * 9.81, 1e-6, "weight on a screen");
        near_absolute(w.wall[deck].force.x, 0.0, 1e-9, "no side force");
        near_absolute(dem_position(&w, 0).z, sqrt(36.0 - 25.0) * 1e-3, 1e-6, "height on four bars");
        dem_free(&w);
    }
}

static void test_wall_motions(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.5, 0.0, 0.0);
    const dem_vec a = {1e-3, 2e-3, 3e-3}, p = {0.3, -1.0, 2.0}, at = {0.1, 0.2, 0.3}, drift = {0.01, -0.02, 0.05};
    const double f = 50.6, rate = 2.0 * RIDDLE_PI * f;
    start(&w, &def);
    int vibrates = dem_add_plane(&w, 0, at, v3(1, 2, 2)), drifts = dem_add_plane(&w, 0, at, up),
        turns = dem_add_cylinder(&w, 0, at, up, 0.1, 1), all = dem_add_plane(&w, 0, at, up);
    assert_int_equal(dem_vibrate(&w, vibrates, a, p, f), DEM_OK);
    assert_int_equal(dem_move(&w, drifts, drift), DEM_OK);
    assert_int_equal(dem_rotate(&w, turns, zero, v3(0, 3, 0), 7.0), DEM_OK);
    assert_int_equal(dem_vibrate(&w, all, a, p, f), DEM_OK);
    assert_int_equal(dem_move(&w, all, drift), DEM_OK);
    assert_int_equal(dem_rotate(&w, all, zero, v3(0, 0, 1), 7.0), DEM_OK);
    for (int k = 0; k < 40; k++) {
        run(&w, 0.0137, DEM_LINEAR);
        double t = w.time, c = cos(7.0 * t), s = sin(7.0 * t);
        const dem_vec shift = v3(a.x * (sin(rate * t + p.x) - sin(p.x)), a.y * (sin(rate * t + p.y) - sin(p.y)),
                                 a.z * (sin(rate * t + p.z) - sin(p.z)));
        const dem_vec speed =
            v3(a.x * rate * cos(rate * t + p.x), a.y * rate * cos(rate * t + p.y), a.z * rate * cos(rate * t + p.z));
        near_vec(w.wall[vibrates].position, v3(at.x + shift.x, at.y + shift.y, at.z + shift.z), 1e-14, "vibration");
        near_vec(w.wall[vibrates].velocity, speed, 1e-11, "its velocity");
        near_vec(w.wall[vibrates].acceleration,
                 v3(-rate * rate * (shift.x + a.x * sin(p.x)), -rate * rate * (shift.y + a.y * sin(p.y)),
                    -rate * rate * (shift.z + a.z * sin(p.z))),
                 1e-8, "its acceleration");
        near_vec(w.wall[vibrates].axis[2], v3(1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0), 1e-15, "its normal");
        near_vec(w.wall[drifts].position, v3(at.x + t * drift.x, at.y + t * drift.y, at.z + t * drift.z), 1e-14,
                 "drift");
        near_vec(w.wall[drifts].velocity, drift, 0.0, "its velocity");
        /* about +y: (x, z) -> (x c + z s, z c - x s) */
        near_vec(w.wall[turns].position, v3(at.x * c + at.z * s, at.y, at.z * c - at.x * s), 1e-13, "rotation");
        near_vec(w.wall[turns].axis[2], v3(s, 0, c), 1e-14, "its axis");
        near_vec(w.wall[turns].velocity, v3(7.0 * w.wall[turns].position.z, 0, -7.0 * w.wall[turns].position.x), 1e-12,
                 "its velocity");
        near_vec(w.wall[all].position,
                 v3(at.x * c - at.y * s + shift.x + t * drift.x, at.x * s + at.y * c + shift.y + t * drift.y,
                    at.z + shift.z + t * drift.z),
                 1e-13, "all three");
    }
    /* a new motion begins where the wall is */
    dem_vec here = w.wall[vibrates].position;
    double began = w.time;
    assert_int_equal(dem_vibrate(&w, vibrates, v3(1e-3, 0, 0), zero, 10.0), DEM_OK);
    near_vec(w.wall[vibrates].position, here, 0.0, "no jump");
    run(&w, 0.01, DEM_LINEAR);
    near_absolute(w.wall[vibrates].position.x, here.x + 1e-3 * sin(20.0 * RIDDLE_PI * (w.time - began)), 1e-14,
                  "and goes on from there");
    dem_free(&w);
}

/* A ball rolls in a turning drum at the angle where gravity and friction balance; a belt carries a ball along. */
static void test_belt(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.5, 0.4, 0.0);
    on_plane(&w, &def, 0.0);
    assert_int_equal(dem_move(&w, 0, v3(0.7, 0, 0)), DEM_OK);
    run(&w, 0.3, DEM_LINEAR | DEM_FRICTION);
    near_relative(dem_velocity(&w, 0).x, 2.0 / 7.0 * 0.7, 1e-3, "a belt gives 2/7 of its speed");
    near_relative(0.7 - dem_velocity(&w, 0).x, -dem_spin(&w, 0).y * radius, 2e-3, "without slip");
    dem_free(&w);
}

/* ---- the screen ---- */

/* Distance of a point from a bar's surface: the section's outline is sampled, the way along the bar is searched. */
static double sampled_bar(int profile, double half, double end, double along, double across, double high) {
    double low = -end, top = end, best = HUGE_VAL;
    for (int k = 0; k < 100; k++) {
        double s[2] = {low + (top - low) / 3.0, top - (top - low) / 3.0},
               square[2] = {(along - s[0]) * (along - s[0]), (along - s[1]) * (along - s[1])};
        if (square[0] < square[1]) top = s[1];
        else low = s[0];
    }
    double da = along - 0.5 * (low + top);
    for (int k = 0; k <= 4000; k++) {
        double angle = (profile == DEM_ROUND ? 2.0 : 1.0) * RIDDLE_PI * k / 4000.0, y = across - half * cos(angle),
               z = high - half * sin(angle);
        best = fmin(best, da * da + y * y + z * z);
        if (profile == DEM_ROUND) continue;
        y = across - half * (2.0 * k / 4000.0 - 1.0);
        best = fmin(best, da * da + y * y + high * high);
    }
    return sqrt(best);
}

static void test_screen_geometry(void **state) {
    (void)state;
    scene_random r = {17};
    int compared = 0, with_two = 0;
    for (int variant = 0; variant < 8; variant++) {
        dem_world w;
        dem_def def = one_material(0.5, 0.3, 0.0);
        dem_screen s = dem_default_screen();
        s.profile = variant & 1 ? DEM_SEMICIRCLE : DEM_ROUND;
        s.circular = variant >> 1 & 1;
        s.half_x = 0.061, s.half_y = s.circular ? 0.0 : 0.043; /* a circular deck needs no half_y */
        s.aperture = 8e-3 - 1e-3 * (variant >> 2), s.wire = 2e-3;
        s.normal = variant & 4 ? v3(0.3, -0.2, 1.0) : up;
        s.direction = variant & 4 ? v3(1.0, 0.5, 0.3) : v3(1, 0, 0);
        s.centre = v3(0.01, 0.02, -0.03);
        start(&w, &def);
        assert_int_equal(dem_add_screen(&w, 0, &s), 0);
        double n = sqrt(s.normal.x * s.normal.x + s.normal.y * s.normal.y + s.normal.z * s.normal.z),
               pitch = s.aperture + s.wire, half = 0.5 * s.wire;
        dem_vec z = v3(s.normal.x / n, s.normal.y / n, s.normal.z / n);
        double dot = z.x * s.direction.x + z.y * s.direction.y + z.z * s.direction.z;
        dem_vec x = v3(s.direction.x - dot * z.x, s.direction.y - dot * z.y, s.direction.z - dot * z.z);
        n = sqrt(x.x * x.x + x.y * x.y + x.z * x.z);
        x = v3(x.x / n, x.y / n, x.z / n);
        dem_vec y = v3(z.y * x.z - z.z * x.y, z.z * x.x - z.x * x.z, z.x * x.y - z.y * x.x);
        double local[60][3], d[60];
        for (int k = 0; k < 60; k++) {
            double size = s.circular ? s.half_x : s.half_y;
            local[k][0] = scene_between(&r, -size, size), local[k][1] = scene_between(&r, -size, size),
            local[k][2] = scene_between(&r, -5e-3, 5e-3);
            d[k] = scene_between(&r, 2e-3, 10e-3);
            if (s.circular && local[k][0] * local[k][0] + local[k][1] * local[k][1] > (size - 0.012) * (size - 0.012))
                k--;
            else
                add(&w,
                    v3(s.centre.x + local[k][0] * x.x + local[k][1] * y.x + local[k][2] * z.x,
                       s.centre.y + local[k][0] * x.y + local[k][1] * y.y + local[k][2] * z.y,
                       s.centre.z + local[k][0] * x.z + local[k][1] * y.z + local[k][2] * z.z),
                    d[k]);
        }
        run(&w, 0.0, DEM_LINEAR | DEM_FRICTION);
        for (int k = 0; k < 60; k++) {
            double least_inside = HUGE_VAL;
            int wanted = 0, got = 0;
            /* Centres inside a bar have no outline distance of their sign. */
            for (int family = 0; family < 2; family++) {
                double across = local[k][1 - family], off = across / pitch - 0.5, near = 0.5 + floor(off + 0.5);
                double dx = across - near * pitch;
                least_inside = fmin(least_inside, sqrt(dx * dx + local[k][2] * local[k][2]) - half);
            }
            if (least_inside < 0.0) continue;
            for (int family = 0; family < 2; family++) {
                for (int bar = -8; bar <= 8; bar++) {
                    double at = (bar - 0.5) * pitch, along = local[k][family], across = local[k][1 - family] - at,
                           end = family ? s.half_y : s.half_x;
                    if (fabs(across) > 0.009) continue;
                    if (s.circular ? fabs(at) >= s.half_x : fabs(at) > (family ? s.half_x : s.half_y)) continue;
                    if (s.circular) end = sqrt(s.half_x * s.half_x - at * at);
                    double gap = sampled_bar((int)s.profile, half, end, along, across, local[k][2]) - 0.5 * d[k],
                           found = nan_;
                    if (fabs(along) > end) continue; /* bars end as one likes */
                    for (ptrdiff_t c = 0; c < dem_contact_count(&w); c++) {
                        dem_contact_info q = dem_get_contact(&w, c);
                        if (q.i == k && q.j == -1 && q.element == 2 * bar + family) found = q.gap;
                    }
                    if (gap < -1e-6) {
                        wanted++;
                        near_absolute(found, gap, 1e-6, "gap to a bar");
                        compared++;
                    } else if (gap > 1e-6 && !isnan(found)) fail_msg("touches a bar that is %g m away", gap);
                }
            }
            for (ptrdiff_t c = 0; c < dem_contact_count(&w); c++) {
                dem_contact_info q = dem_get_contact(&w, c);
                got += q.i == k && q.j == -1;
                if (q.i == k && q.j == -1)
                    near_absolute(sqrt(q.force.x * q.force.x + q.force.y * q.force.y + q.force.z * q.force.z),
                                  1e5 * -q.gap, 1e-6, "force of a bar");
            }
            assert_true(got >= wanted);
            with_two += wanted > 1;
        }
        dem_free(&w);
    }
    print_message("%d gaps to bars compared, %d spheres on several bars\n", compared, with_two);
    assert_true(compared > 150 && with_two > 30);
}

/* A gap is a distance: no way to anywhere, outside of the bars, changes it by more than its length; round their ends as
   well, where a sphere that floats from the flat side to the round one gets no energy. */
static void test_ends_of_bars(void **state) {
    (void)state;
    const double grain = 1e-3;
    scene_random r = {31};
    for (int profile = 0; profile < 2; profile++) {
        dem_world w;
        dem_def def = one_material(1.0, 0.0, 0.0);
        dem_screen s = dem_default_screen();
        dem__touch touch[2];
        int compared = 0;
        def.gravity = zero;
        s.profile = profile ? DEM_SEMICIRCLE : DEM_ROUND;
        s.circular = 0, s.half_x = s.half_y = 0.02;
        start(&w, &def);
        const int deck = dem_add_screen(&w, 0, &s);
        for (int k = 0; k < 100000; k++) {
            const dem_vec x = v3(0.02 + scene_between(&r, -2e-3, 3e-3), 0.005 + scene_between(&r, -3e-3, 3e-3),
                                 scene_between(&r, -2e-3, 2e-3));
            const dem_vec way = scene_vector(&r, k & 1 ? 1e-3 : 1e-6);
            dem__touch_element(&w.wall[deck], x, grain, 2, &touch[0]);
            dem__touch_element(&w.wall[deck], dem__add(x, way), grain, 2, &touch[1]);
            if (touch[0].gap < -grain || touch[1].gap < -grain || x.z * (x.z + way.z) < 0.0) continue;
            near_absolute(touch[1].gap - touch[0].gap, 0.0, dem__length(way) + 1e-15, "change of a gap");
            near_absolute(dem__length(touch[0].normal), 1.0, 1e-12, "length of a normal");
            if (!(k & 1) && touch[0].gap > -0.9 * grain)
                near_absolute(touch[1].gap - touch[0].gap, dem__dot(way, touch[0].normal), 1e-7,
                              "change along the normal");
            compared++;
        }
        assert_true(compared > 50000);
        for (int k = 0; k < 100; k++) { /* through the plane of the deck */
            const dem_vec x =
                v3(0.02 + 1.2 * grain + scene_between(&r, 0.0, 0.9e-3), 0.005 + scene_between(&r, -1e-3, 1e-3), 0.0);
            dem__touch_element(&w.wall[deck], x, grain, 2, &touch[0]);
            dem__touch_element(&w.wall[deck], dem__add(x, v3(0, 0, -1e-12)), grain, 2, &touch[1]);
            near_absolute(touch[1].gap, touch[0].gap, 1e-11, "gap on either side of the plane");
        }
        add(&w, v3(0.02 + grain + 1.2e-3, 0.005, -0.5e-3), 2.0 * grain);
        move(&w, 0, v3(-0.05, 0, 0.1), zero);
        run(&w, 0.02, DEM_LINEAR | DEM_ENERGY);
        assert_true(w.contact_steps > 5);
        near_absolute(dem__length(dem_velocity(&w, 0)), hypot(0.05, 0.1), 1e-4, "speed after a bar's end");
        dem_free(&w);
    }
}

/* Over, under and beside a deck the nearest bar is among those that are looked at, for spheres wider than its
   pitch as well. */
static void test_edge_of_a_deck(void **state) {
    (void)state;
    scene_random r = {11};
    dem_world w;
    dem_def def = one_material(1.0, 0.0, 0.0);
    dem_screen s = dem_default_screen();
    int compared = 0;
    s.aperture = 3e-3, s.wire = 1e-3, s.circular = 0, s.half_x = 0.0145, s.half_y = 0.0105;
    start(&w, &def);
    const dem_wall *deck = &w.wall[dem_add_screen(&w, 0, &s)];
    for (int k = 0; k < 100000; k++) {
        const double size = scene_between(&r, 1e-3, 6e-3);
        const dem_vec x =
            v3(scene_between(&r, -0.025, 0.025), scene_between(&r, -0.02, 0.02), scene_between(&r, -8e-3, 8e-3));
        dem__touch touch[DEM__TOUCHES];
        double least = HUGE_VAL, bound, found = HUGE_VAL;
        for (int bar = -8; bar < 20; bar++) {
            dem__touch_element(deck, x, size, bar, &touch[0]);
            least = fmin(least, touch[0].gap);
        }
        const int n = dem__touch_wall(deck, x, size, HUGE_VAL, touch, &bound);
        for (int q = 0; q < n; q++) found = fmin(found, touch[q].gap);
        if (least < -0.1 * size) continue;
        assert_true(bound <= least && found >= least);
        if (least > 1e-3) continue;
        near_absolute(found, least, 1e-15, "gap of the nearest bar");
        compared++;
    }
    print_message("%d nearest bars compared\n", compared);
    assert_true(compared > 5000);
    dem_free(&w);
}

static void test_apertures(void **state) {
    (void)state;
    static const struct {
        double d;
        int occupied, blocked;
    } c[] = {{7.9e-3, 0, 0}, {8.05e-3, 1, 1}, {8.3e-3, 1, 1}, {9e-3, 1, 0}, {10e-3, 1, 0}};
    for (size_t k = 0; k < sizeof c / sizeof *c; k++) {
        dem_world w;
        dem_def def = one_material(0.1, 0.3, 0.0);
        dem_screen s = dem_default_screen();
        s.normal = v3(0.0, 0.02, 1.0);
        start(&w, &def);
        int deck = dem_add_screen(&w, 0, &s), total = 0;
        dem_apertures n = dem_count_apertures(&w, deck);
        for (int i = -20; i <= 20; i++)
            for (int j = -20; j <= 20; j++) total += hypot(0.01 * abs(i) + 0.005, 0.01 * abs(j) + 0.005) <= 0.095;
        assert_int_equal(n.total, total);
        assert_true(n.free == total && n.occupied == 0);
        add(&w, v3(0.02, -0.03, 0.008), c[k].d);
        move(&w, 0, v3(0, 0, -0.3), zero);
        run(&w, 0.3, DEM_LINEAR | DEM_FRICTION);
        n = dem_count_apertures(&w, deck);
        assert_int_equal(n.occupied, c[k].occupied);
        assert_int_equal(n.free, total - c[k].blocked);
        assert_true(c[k].occupied ? fabs(dem_position(&w, 0).z) < 0.005 : dem_position(&w, 0).z < -0.1);
        dem_free(&w);
    }
    dem_world w; /* a rectangular deck */
    dem_def def = one_material(0.1, 0.3, 0.0);
    dem_screen s = dem_default_screen();
    s.circular = 0, s.half_x = 0.0251, s.half_y = 0.0151;
    start(&w, &def);
    int deck = dem_add_screen(&w, 0, &s);
    assert_int_equal(dem_count_apertures(&w, deck).total, 5 * 3);
    assert_int_equal(dem_count_apertures(&w, 7).total, 0);
    assert_int_equal(dem_count_apertures(&w, -1).total, 0);
    assert_int_equal(dem_count_apertures(NULL, 0).total, 0);
    dem_free(&w);
}

/* ---- boundaries ---- */

static void test_periodic(void **state) {
    (void)state;
    dem_vec out[2][2], spin[2];
    /* the same collision, in the middle and across the edge, several boxes on */
    for (int across = 0; across < 2; across++) {
        dem_world w;
        dem_def def = one_material(0.7, 0.3, 0.0);
        def.gravity = zero;
        def.periodic[0] = def.periodic[1] = def.periodic[2] = 1;
        def.low = v3(-0.0625, -0.0625, -0.0625), def.high = v3(0.0625, 0.0625, 0.0625);
        start(&w, &def);
        double shift = across ? 0.0625 + 0.125 * 3.0 : 0.0;
        add(&w, v3(shift, 0.001, -0.0039), diameter), add(&w, v3(shift + 0.001, 0, 0.0039), diameter);
        move(&w, 0, v3(0, 0, 1), v3(1, 2, 3)), move(&w, 1, v3(0, 0.5, -1), zero);
        run(&w, 0.01, DEM_LINEAR | DEM_FRICTION);
        for (int i = 0; i < 2; i++) {
            out[across][i] = dem_velocity(&w, i);
            dem_vec x = dem_position(&w, i);
            assert_true(x.x >= -0.0625 && x.x <= 0.0625 && x.y >= -0.0625 && x.y <= 0.0625 && x.z >= -0.0625 &&
                        x.z <= 0.0625);
        }
        spin[across] = v3(dem_spin(&w, 0).x, dem_spin(&w, 0).y, dem_spin(&w, 0).z);
        assert_true(w.contact_steps > 5);
        dem_free(&w);
    }
    for (int i = 0; i < 2; i++) near_vec(out[0][i], out[1][i], 1e-10, "velocity");
    near_vec(spin[0], spin[1], 1e-7, "spin");
    dem_world w; /* a flight round and round */
    dem_def def = one_material(0.7, 0.3, 0.0);
    def.gravity = zero;
    def.periodic[0] = 1, def.low.x = 0.0, def.high.x = 0.1;
    start(&w, &def);
    add(&w, v3(0.05, 0, 0), diameter);
    move(&w, 0, v3(3, 0, 0), zero);
    run(&w, 1.0, DEM_LINEAR);
    near_absolute(dem_position(&w, 0).x, 0.05 + 3.0 * w.time - 0.1 * floor((0.05 + 3.0 * w.time) / 0.1), 1e-9,
                  "thirty boxes on");
    dem_free(&w);
    def.high.x = 2.19 * diameter; /* too narrow for its spheres */
    start(&w, &def);
    add(&w, v3(0.005, 0, 0), diameter);
    assert_int_equal(dem_run(&w, 0.1, DEM_LINEAR), DEM_BAD_DEFINITION);
    dem_free(&w);
}

/* Walls are not repeated: who leaves the box by one face may meet a wall at the other. When that is noticed does not
   depend on what is skipped. Down a slope without end each box gives its height, and the ledger adds up. */
static void test_walls_of_a_periodic_box(void **state) {
    (void)state;
    const int skip[] = {DEM_SKIP_ALL, 0, DEM_SKIP_SPACE, DEM_SKIP_PAIRS};
    uint64_t hash[4];
    for (int k = 0; k < 4; k++) {
        dem_world w;
        scene_random r = {8};
        dem_def def = one_material(0.9, 0.3, 0.0);
        dem_screen s = dem_default_screen();
        def.skip = skip[k];
        def.gravity = v3(1.0, 0.0, -3.0);
        def.periodic[0] = def.periodic[1] = 1;
        def.low = v3(-0.05, -0.05, 0), def.high = v3(0.05, 0.05, 0);
        start(&w, &def);
        dem_add_plane(&w, 0, zero, up);
        dem_add_cylinder(&w, 0, v3(-0.049, 0, 0), up, 0.004, 0);
        dem_add_sphere_wall(&w, 0, v3(0, 0.049, 0.01), 0.005, 0);
        s.centre = v3(0, 0, 0.03), s.circular = 0, s.half_x = 0.021, s.half_y = 0.047;
        dem_add_screen(&w, 0, &s);
        for (int i = 0; i < 100; i++) {
            add(&w, v3(-0.04 + 0.008 * (i % 10), -0.04 + 0.008 * (i / 10), 0.04), 2e-3);
            move(&w, i, scene_vector(&r, 1.0), zero);
        }
        run(&w, 0.3, DEM_LINEAR | DEM_FRICTION);
        assert_true(w.contact_steps > 1000);
        hash[k] = dem_hash(&w);
        dem_free(&w);
    }
    for (int k = 1; k < 4; k++) assert_true(hash[k] == hash[0]);
    for (int threads = 1; threads < 3; threads++) {
        dem_world w;
        dem_def def = one_material(0.7, 0.3, 0.0);
        def.threads = threads;
        def.gravity = v3(5.0, 0.0, -8.0);
        def.periodic[0] = 1;
        def.low.x = 0.0, def.high.x = 0.1;
        start(&w, &def);
        dem_add_plane(&w, 0, zero, up);
        for (int i = 0; i < 100; i++) add(&w, v3(0.01 * (i % 10), 0.01 * (i / 10 % 10), 0.01), 5e-3);
        run(&w, 0.5, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY);
        const dem_energy_ledger l = dem_energy(&w);
        const double mass = 100.0 * dem_mass(&w, 0);
        assert_true(l.kinetic > 2.0 * mass * 5.0 * 0.1); /* several boxes on */
        near_absolute(l.error, 0.0, 1e-3 * l.kinetic, "a slope's ledger");
        near_absolute(l.released,
                      l.kinetic + l.rotational + l.elastic + l.normal_loss + l.sliding_loss + l.rolling_loss,
                      1e-3 * l.kinetic, "what the slope gave");
        dem_free(&w);
    }
}

/* The margin of the list gives way to a narrow box: what happens in it is the same with a margin that fits. */
static void test_narrow_box(void **state) {
    (void)state;
    const double width = 2.25 * diameter, skin[] = {0.05, 0.7, 5.0};
    uint64_t hash[3];
    for (int k = 0; k < 3; k++) {
        dem_world w;
        dem_def def = one_material(0.7, 0.3, 0.0);
        def.skin = skin[k];
        def.gravity = zero;
        for (int a = 0; a < 3; a++) def.periodic[a] = 1;
        def.low = zero, def.high = v3(width, width, 1.02 * width);
        start(&w, &def);
        for (int i = 0; i < 8; i++) {
            add(&w, v3(0.5 * width * (i & 1), 0.5 * width * (i >> 1 & 1), 0.5 * width * (i >> 2)),
                i == 5 ? 0.5 * diameter : diameter);
            move(&w, i, v3(i == 3 ? 2.0 : 0.1 * i, i == 6 ? -3.0 : 0.0, i == 1 ? 1.0 : -0.1 * i), zero);
        }
        run(&w, 0.05, DEM_LINEAR | DEM_FRICTION);
        assert_true(w.contact_steps > 1000);
        hash[k] = dem_hash(&w);
        dem_free(&w);
    }
    assert_true(hash[0] == hash[1] && hash[1] == hash[2]);
}

/* Where spheres are fast, the margin of the list is wider, up to three times, so that lists last 100 steps; how fast
   all of them are together, and that they fall together, is no reason for a new one. */
/* Wherever a sphere is put, it is in the box: so far out that nothing else is known of its place. */
static void test_far_outside_a_box(void **state) {
    (void)state;
    const double far_out[] = {1.0, -7.03, 1e9, 9.3032915081612809e+52, -1e300};
    dem_def def = one_material(0.5, 0.3, 0.0);
    def.periodic[0] = 1, def.low.x = 0.0, def.high.x = 0.06;
    for (int k = 0; k < 5; k++) {
        dem_world w;
        start(&w, &def);
        add(&w, v3(far_out[k], 0, 0), diameter);
        add(&w, v3(0.01, 0.1, 0), diameter);
        run(&w, 1e-3, DEM_LINEAR);
        assert_true(dem_position(&w, 0).x >= 0.0 && dem_position(&w, 0).x <= 0.06);
        dem_free(&w);
    }
    dem_world w;
    const char *field = NULL;
    def.low.x = -1e308, def.high.x = 1e308;
    assert_int_equal(dem_init(&w, &def, &field), DEM_BAD_DEFINITION);
    assert_string_equal(field, "high");
}

static void test_lists_last(void **state) {
    (void)state;
    static const struct {
        double speed, apart; /* diameters a step; places of a lattice, in diameters */
        double lasts;        /* steps, to 30 %; 0: as long as the run, -1: less, with the widest margin */
        double drift, fall;  /* of all, in diameters a step and [m/s2] */
    } of[] = {{1e-5, 3.0, 0.0, 0.0, 0.0},    {5e-4, 3.0, 400.0, 0.0, 0.0}, {2e-3, 1.3, 100.0, 0.0, 0.0},
              {0.02, 3.0, -1.0, 0.0, 0.0},   {1e-5, 3.0, 0.0, 0.02, 0.0},  {1e-5, 3.0, 0.0, 0.02, 9.81},
              {5e-4, 3.0, 400.0, 0.02, 9.81}};
    for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
        const double box = 6.0 * of[k].apart * diameter;
        dem_world w;
        scene_random r = {5};
        dem_def def = one_material(1.0, 0.3, 0.0);
        def.gravity = v3(0.0, 0.6 * of[k].fall, -0.8 * of[k].fall);
        for (int a = 0; a < 3; a++) def.periodic[a] = 1;
        def.low = zero, def.high = v3(box, box, box);
        start(&w, &def);
        for (int i = 0; i < 216; i++) {
            const dem_vec v = scene_vector(&r, of[k].speed * diameter / def.dt);
            add(&w, v3(box * (i % 6 + 0.5) / 6.0, box * (i / 6 % 6 + 0.5) / 6.0, box * (i / 36 + 0.5) / 6.0), diameter);
            move(&w, i, v3(v.x, v.y + of[k].drift * diameter / def.dt, v.z), zero);
        }
        run(&w, 4000 * def.dt, DEM_LINEAR);
        const double skin = w.engine->pairs.skin / (def.skin * diameter), life = 4000.0 / (double)w.rebuilds;
        if (of[k].lasts == 0.0) assert_true(skin == 1.0 && w.rebuilds == 1);
        else if (of[k].lasts < 0.0) near_absolute(skin, 3.0, 1e-12, "skin");
        else assert_true(skin > 1.0 && skin < 3.0 && fabs(life / of[k].lasts - 1.0) < 0.3);
        dem_free(&w);
    }
}

static void test_exits(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.7, 0.3, 0.0);
    start(&w, &def);
    int exits[2] = {dem_add_exit(&w, v3(0, 0, 0), v3(0, 0, 2)), dem_add_exit(&w, v3(0, 0, 1e-6), up)};
    for (int k = 0; k < 300; k++) { /* in an order of its own; 300 need more than one growth of the record */
        double at[3] = {0.01 * k, 0, 0.01 + 1e-5 * (k * 7919 % 300)}, d = 4e-3 + 1e-6 * k;
        assert_int_equal(dem_add_spheres(&w, 1, at, &d, 0, 1000 + k), DEM_OK);
    }
    run(&w, 0.02, DEM_LINEAR);
    assert_int_equal(w.passed_count, 0);
    run(&w, 0.08, DEM_LINEAR);
    assert_int_equal(w.passed_count, 300);
    for (ptrdiff_t k = 0; k < 300; k++) {
        const dem_passed *p = &w.passed[k];
        double z = 0.01 + 1e-5 * ((int)p->id * 7919 % 300), t = sqrt(2.0 * (z - 1e-6) / 9.81);
        assert_true(p->time >= t && p->time < t + def.dt * (1 + 1e-6));
        assert_true(p->exit == exits[1] || p->exit == exits[0]);
        assert_int_equal(p->group, 1000 + (int)p->id);
        near_relative(p->diameter, 4e-3 + 1e-6 * (double)p->id, 1e-15, "diameter");
        near_absolute(p->position.z, z - 0.5 * 9.81 * p->time * p->time, 1e-12, "where");
        near_relative(p->velocity.z, -9.81 * p->time, 1e-12, "how fast");
        if (k > 0) assert_true(p->time > p[-1].time || (p->time == p[-1].time && p->id > p[-1].id));
        for (ptrdiff_t q = 0; q < k; q++) assert_true(w.passed[q].id != p->id);
    }
    run(&w, 0.01, DEM_LINEAR);
    add(&w, v3(0, 0, 0.1), diameter); /* ids go on */
    assert_int_equal(w.id[w.count - 1], 300);
    dem_free(&w);
    /* both exits in the same step: the one with the smaller index */
    start(&w, &def);
    dem_add_exit(&w, v3(0, 0, 0), up), dem_add_exit(&w, v3(0, 0, 0), up);
    add(&w, v3(0, 0, 1e-3), diameter), add(&w, v3(0, 0.1, 1e-3), diameter);
    run(&w, 0.03, DEM_LINEAR);
    assert_true(w.passed_count == 2 && w.passed[0].exit == 0 && w.passed[1].exit == 0 && w.passed[0].id == 0 &&
                w.passed[1].id == 1);
    dem_free(&w);
}

static void test_exit_in_contact(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.7, 0.3, 0.0);
    def.gravity = v3(1, 0, -9.81);
    start(&w, &def);
    dem_add_plane(&w, 0, zero, up);
    dem_add_exit(&w, v3(0.03, 0, 0), v3(-1, 0, 0));
    /* a train that touches the floor and each other */
    for (int k = 0; k < 4; k++) add(&w, v3(-0.005 * k, 0, radius), diameter);
    run(&w, 1.0, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY);
    assert_int_equal(w.passed_count, 4);
    assert_int_equal(dem_contact_count(&w), 0);
    dem_energy_ledger l = dem_energy(&w);
    assert_true(fabs(l.error) < 2e-3 * (l.removed - l.removed_potential + l.released) && l.kinetic == 0.0);
    dem_free(&w);
    /* the record of one that has gone round a periodic box lies in the box */
    dem_def round = def;
    round.gravity = zero, round.periodic[0] = 1, round.low = v3(0, 0, 0), round.high = v3(0.03, 1, 1);
    start(&w, &round);
    dem_add_exit(&w, v3(0, 0, 0), v3(0, 0, 1));
    add(&w, v3(5e-3, 0, 0.01), diameter);
    move(&w, 0, v3(3.0, 0, -0.5), zero);
    run(&w, 0.05, DEM_LINEAR);
    assert_true(w.passed_count == 1 && w.passed[0].position.x >= 0.0 && w.passed[0].position.x < 0.03);
    dem_free(&w);
    /* who was pushed by one that has left flies free of its force */
    def.gravity = v3(0, 0, 0.3);
    start(&w, &def);
    dem_add_exit(&w, v3(0, 0, 0), v3(0, 0, 1));
    add(&w, v3(0, 0, 2e-5), diameter), add(&w, v3(0, 0, 1e-5 + diameter), diameter);
    move(&w, 0, v3(0, 0, -1.0), zero), move(&w, 1, v3(0, 0, -2.0), zero);
    run(&w, 4e-5, DEM_LINEAR | DEM_FRICTION);
    assert_true(w.passed_count == 1 && dem_contact_count(&w) == 0 && dem_velocity(&w, 1).z > -2.0);
    const dem_vec v = dem_velocity(&w, w.count - 1);
    const double since = w.time;
    run(&w, 1e-3, DEM_LINEAR | DEM_FRICTION);
    near_absolute(dem_velocity(&w, w.count - 1).z, v.z + 0.3 * (w.time - since), 1e-12,
                  "flight after a partner's leaving");
    dem_free(&w);
}

static void test_enable_wall(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.1, 0.3, 0.0);
    on_plane(&w, &def, 0.0);
    run(&w, 0.05, DEM_LINEAR);
    double z = dem_position(&w, 0).z, t = w.time;
    assert_int_equal(dem_enable_wall(&w, 0, 0), DEM_OK);
    run(&w, 0.05, DEM_LINEAR);
    near_absolute(dem_position(&w, 0).z, z - 0.5 * 9.81 * (w.time - t) * (w.time - t), 1e-9, "falls");
    assert_int_equal(dem_enable_wall(&w, 0, 1), DEM_OK); /* below it now: pushed out is what a half space does */
    assert_int_equal(dem_enable_wall(&w, 0, 0), DEM_OK);
    run(&w, 0.01, DEM_LINEAR);
    assert_int_equal(dem_contact_count(&w), 0);
    dem_free(&w);
}

static void test_loads(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.2, 0.5, 0.0);
    double m = mass_of(diameter);
    on_plane(&w, &def, 0.0);
    assert_int_equal(dem_set_load(&w, 0, v3(0, 0, -10.0 * m), zero), DEM_OK);
    run(&w, 0.1, DEM_LINEAR | DEM_FRICTION);
    near_relative(-w.wall[0].force.z, m * 19.81, 1e-6, "weight and load");
    assert_int_equal(dem_set_load(&w, 0, v3(0, 0, 9.81 * m), zero), DEM_OK); /* hovers */
    run(&w, 0.1, DEM_LINEAR | DEM_FRICTION);
    assert_true(dem_position(&w, 0).z > radius - 1e-7);
    assert_int_equal(dem_set_load(&w, 0, zero, zero), DEM_OK);
    run(&w, 0.4, DEM_LINEAR | DEM_FRICTION);
    near_relative(-w.wall[0].force.z, m * 9.81, 1e-5, "weight again");
    dem_free(&w);
}

/* ---- skipping changes no bit, and misses nothing ---- */

static void test_skipping_changes_no_bit(void **state) {
    (void)state;
    for (int scene = 0; scene < SCENE_COUNT; scene++) {
        uint64_t hash[4][4];
        for (int skip = 0; skip < 4; skip++) {
            dem_world w;
            assert_int_equal(scene_make(&w, scene, skip, 1, NULL), DEM_OK);
            for (int part = 0; part < 4; part++) {
                run(&w, 0.25 * scene_duration(scene), scene_features(scene));
                hash[skip][part] = dem_hash(&w);
            }
            assert_true(w.contact_steps > 1000);
            if (scene == SCENE_SCREEN) assert_true(w.passed_count > 5);
            dem_free(&w);
        }
        for (int skip = 1; skip < 4; skip++) {
            for (int part = 0; part < 4; part++) {
                if (hash[skip][part] != hash[0][part])
                    fail_msg("scene %s: skip = %d gives other bits in quarter %d", scene_name(scene), skip, part + 1);
            }
        }
    }
}

/* The ledger looks and does not touch: the same motion, bit for bit. */
static void test_ledger_changes_no_bit(void **state) {
    (void)state;
    for (int scene = 0; scene < SCENE_COUNT; scene++) {
        dem_world w, l;
        assert_int_equal(scene_make(&w, scene, DEM_SKIP_ALL, 1, NULL), DEM_OK);
        assert_int_equal(scene_make(&l, scene, DEM_SKIP_ALL, 1, NULL), DEM_OK);
        run(&w, 0.5 * scene_duration(scene), scene_features(scene)),
            run(&l, 0.5 * scene_duration(scene), scene_features(scene) | DEM_ENERGY);
        assert_int_equal(w.count, l.count);
        for (ptrdiff_t i = 0; i < w.count; i++)
            near_vec(dem_position(&w, i), dem_position(&l, i), 0.0, scene_name(scene));
        dem_energy_ledger e = dem_energy(&l);
        double scale = fabs(e.wall_work) + e.released + fabs(e.start - e.start_potential);
        print_message("%s: ledger open by %.1e\n", scene_name(scene), fabs(e.error) / scale);
        assert_true(fabs(e.error) < 5e-3 * scale);
        dem_free(&w), dem_free(&l);
    }
}

/* Every overlap of two spheres must be a live contact, at the latest in the step after it came to be. */
static void test_no_contact_is_missed(void **state) {
    (void)state;
    long overlaps = 0;
    for (int trial = 0; trial < 12; trial++) {
        dem_world w;
        scene_random r = {(uint64_t)trial + 100};
        dem_def def = scene_def(4e-6);
        int n = 0;
        def.skin = trial % 3 == 0 ? 0.02 : trial % 3 == 1 ? 0.15 : 1.0;
        def.gravity = scene_vector(&r, trial % 2 ? 100.0 : 0.0);
        dem_pair(&def, 0, 0)->stiffness = dem_pair(&def, 0, 1)->stiffness = 1e3;
        if (trial % 4 > 1) {
            def.periodic[0] = def.periodic[2] = 1;
            def.low = v3(-0.05, -0.05, -0.05), def.high = v3(0.05, 0.05, 0.05);
        }
        start(&w, &def);
        scene_box(&w, 0.05, -0.05, 0.05);
        for (; n < 60; n++) { /* sizes 1:10, some very fast, some slow and grazing */
            double d = pow(10.0, scene_between(&r, -3.0, -2.0)), speed = n % 5 == 0   ? 0.2 * 1e-3 / def.dt
                                                                         : n % 5 == 1 ? 0.01
                                                                                      : 3.0;
            dem_vec at = scene_vector(&r, 0.044);
            for (int i = 0; i < n; i++) { /* no overlap yet: try elsewhere */
                dem_vec x = dem_position(&w, i);
                if (sqrt((x.x - at.x) * (x.x - at.x) + (x.y - at.y) * (x.y - at.y) + (x.z - at.z) * (x.z - at.z)) <
                    dem_radius(&w, i) + 0.5 * d)
                    at = scene_vector(&r, 0.044), i = -1;
            }
            add(&w, at, d);
            dem_vec v = scene_vector(&r, 1.0);
            double size = sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
            move(&w, n, v3(speed * v.x / size * 0.3, speed * v.y / size * 0.3, speed * v.z / size * 0.3), zero);
        }
        unsigned char before[60][60];
        memset(before, 0, sizeof before);
        for (int s = 0; s < 1500; s++) {
            unsigned char now[60][60];
            run(&w, def.dt, DEM_LINEAR);
            memset(now, 0, sizeof now);
            for (int i = 0; i < n; i++) {
                for (int j = i + 1; j < n; j++) {
                    dem_vec a = dem_position(&w, i), b = dem_position(&w, j), d = v3(a.x - b.x, a.y - b.y, a.z - b.z);
                    if (def.periodic[0]) d.x -= 0.1 * floor(d.x / 0.1 + 0.5), d.z -= 0.1 * floor(d.z / 0.1 + 0.5);
                    now[i][j] = sqrt(d.x * d.x + d.y * d.y + d.z * d.z) <
                                (dem_radius(&w, i) + dem_radius(&w, j)) * (1.0 - 1e-12);
                    overlaps += now[i][j];
                }
            }
            for (ptrdiff_t c = 0; c < dem_contact_count(&w); c++) {
                dem_contact_info q = dem_get_contact(&w, c);
                if (q.j >= 0) now[q.i][q.j] = 0;
            }
            for (int i = 0; i < n; i++) {
                for (int j = i + 1; j < n; j++) {
                    if (now[i][j] && before[i][j])
                        fail_msg("trial %d, step %d: spheres %d and %d overlap and are no contact", trial, s, i, j);
                }
            }
            memcpy(before, now, sizeof now);
        }
        dem_free(&w);
    }
    print_message("%ld overlaps looked at\n", overlaps);
    assert_true(overlaps > 3000);
}

/* ---- saving ---- */

static unsigned char *saved(const dem_world *w, size_t *size) {
    *size = dem_save(w, NULL, 0);
    unsigned char *bytes = malloc(*size);
    assert_non_null(bytes);
    memset(bytes, 0xEE, *size);
    assert_int_equal(dem_save(w, bytes, *size - 1), *size); /* too small: nothing is written */
    for (size_t k = 0; k < *size; k++) assert_int_equal(bytes[k], 0xEE);
    assert_int_equal(dem_save(w, bytes, *size), *size);
    return bytes;
}

/* A thread adds first to sums of particles whose contacts are all in its sections or later ones: none may be in one
   before its own. */
static void check_sections(const dem_world *w) {
    DEM__EACH_CONTACT(w, c) {
        const int section = (int)(in_c - w->engine->contacts.chunk);
        int own = 0;
        while (dem__rank_in_slot(w, c) < w->engine->contacts.chunk[own].first_rank) own++;
        assert_in_range(section, own, w->engine->contacts.chunk_count - 1);
        assert_true(w->engine->contacts.j[c] < 0 || w->engine->contacts.i[c] < w->engine->contacts.j[c]);
    }
}

/* Runs the tasks of a loop one after the other, the last one first. */
static void run_last_first(void *user, int tasks, void (*task)(void *context, int index), void *context) {
    for (int k = tasks - 1; k >= 0; k--) task(context, k);
    *(int *)user = tasks > *(int *)user ? tasks : *(int *)user;
}
/* A block of 16 x 16 spheres in some layers, which overlap by 1e-5 m, added in steps of `stride` through the block. */
static dem_status make_block(dem_world *w, int layers, int stride, int threads, int *most) {
    const int n = 16 * 16 * layers;
    dem_def def = dem_default_def();
    const int glass = dem_add_material(&def, 2500.0, 5e9, 0.2);
    const double size = 5e-3, apart = 4.99e-3;
    def.dt = 4e-6, def.threads = threads, def.parallel = run_last_first, def.parallel_user = most;
    dem_status status = dem_init(w, &def, NULL);
    if (status == DEM_OK && dem_add_plane(w, glass, dem_vec3(0.0, 0.0, 0.0), dem_vec3(0.0, 0.0, 1.0)) < 0)
        status = DEM_TOO_MANY;
    for (int m = 0; m < n && status == DEM_OK; m++) {
        const int k = (int)((long long)m * stride % n);
        const double centre[3] = {k % 16 * apart, k / 16 % 16 * apart, (k / 256 + 0.5) * apart};
        status = dem_add_spheres(w, 1, centre, &size, glass, k);
    }
    return status;
}
/* Contacts lie by place, whatever the order in which spheres were added; numbers stay. Threads and saves
   change nothing. */
static void test_order_by_place(void **state) {
    (void)state;
    uint64_t hash[4] = {0};
    for (int k = 0; k < 4; k++) {
        const int threads[] = {1, 1, 7, 64};
        int most = 0;
        dem_world w, copy;
        /* 1237 and 15360 have no common divisor */
        assert_int_equal(make_block(&w, 60, k ? 1237 : 1, threads[k], &most), DEM_OK);
        run(&w, 40 * w.def.dt, DEM_LINEAR | DEM_FRICTION);
        assert_true(w.engine->contacts.chunk_count > 16 && (k < 2 || most > (k == 2 ? 6 : 16)));
        double apart = 0.0; /* of particles that follow each other in the order [m] */
        for (ptrdiff_t r = 1; r < w.count; r++) {
            const dem_vec a = dem_position(&w, w.engine->bodies.by_rank[r - 1]),
                          b = dem_position(&w, w.engine->bodies.by_rank[r]);
            apart += sqrt(pow(a.x - b.x, 2) + pow(a.y - b.y, 2) + pow(a.z - b.z, 2)) / (double)(w.count - 1);
        }
        assert_true(apart < 8e-3); /* neighbours are 4.99e-3 m apart */
        for (ptrdiff_t i = 0; i < w.count; i++)
            assert_true(w.id[i] == (uint64_t)i && w.group[i] == (k ? i * 1237 % w.count : i));
        for (ptrdiff_t i = 0; i < w.count; i += 5) assert_int_equal(dem_remove(&w, i), DEM_OK);
        check_sections(&w);
        size_t size;
        unsigned char *bytes = saved(&w, &size);
        assert_int_equal(dem_load(&copy, bytes, size, NULL), DEM_OK);
        free(bytes);
        run(&w, 40 * w.def.dt, DEM_LINEAR | DEM_FRICTION);
        run(&copy, 40 * w.def.dt, DEM_LINEAR | DEM_FRICTION);
        check_sections(&w);
        check_sections(&copy);
        hash[k] = dem_hash(&w);
        assert_true(hash[k] == dem_hash(&copy));
        dem_free(&copy);
        dem_free(&w);
    }
    assert_true(hash[1] == hash[2] && hash[1] == hash[3]);
}

/* Runs the tasks of a loop one after the other, and notes whether particles lie by place. user: the world. */
static void run_and_look(void *user, int tasks, void (*task)(void *context, int index), void *context) {
    dem_world *w = user;
    for (int k = 0; k < tasks; k++) task(context, k);
    *(int *)w->user |= w->engine->bodies.by_place;
}
/* In a long run particles lie by place, in a short one by their numbers: the same bits, records and numbers, while some
   leave, lists are made anew and ranks, too. */
static void test_order_in_memory(void **state) {
    (void)state;
    int most = 0;
    dem_world start, w[2];
    assert_int_equal(make_block(&start, 15, 1237, 1, &most), DEM_OK);
    assert_true(dem_add_exit(&start, dem_vec3(15 * 4.99e-3 + 1.5e-3, 0.0, 0.0), dem_vec3(-1.0, 0.0, 0.0)) > 0);
    run(&start, 2000 * start.def.dt, DEM_LINEAR | DEM_FRICTION);
    for (ptrdiff_t i = 0; i < start.count; i++) {
        if (start.alive[i] && dem_position(&start, i).x > 13.5 * 4.99e-3 && i % 4)
            assert_int_equal(
                dem_set_motion(&start, i, dem_vec3(6.0 + 1e-3 * (double)(i % 7), 0.0, 0.0), dem_vec3(0.0, 0.0, 0.0)),
                DEM_OK);
    }
    size_t size;
    unsigned char *bytes = saved(&start, &size);
    for (int k = 0; k < 2; k++) {
        const int steps = k ? 1 : 140;
        int by_place = 0;
        assert_int_equal(dem_load(&w[k], bytes, size, NULL), DEM_OK);
        w[k].def.threads = 4, w[k].def.parallel = run_and_look, w[k].def.parallel_user = &w[k], w[k].user = &by_place;
        for (int done = 0; done < 280; done += steps) run(&w[k], steps * w[k].def.dt, DEM_LINEAR | DEM_FRICTION);
        assert_true(by_place == !k && w[k].step > 2048 && w[k].rebuilds > start.rebuilds &&
                    !w[k].engine->bodies.by_place);
        assert_true(w[k].count < start.count && w[k].passed_count > start.count / 16);
    }
    assert_true(w[0].passed_count == w[1].passed_count && w[0].count == w[1].count &&
                dem_hash(&w[0]) == dem_hash(&w[1]));
    assert_memory_equal(w[0].passed, w[1].passed, (size_t)w[0].passed_count * sizeof *w[0].passed);
    for (ptrdiff_t i = 0; i < w[0].count; i++) {
        assert_true(w[0].id[i] == w[1].id[i] && w[0].group[i] == w[1].group[i] &&
                    (i == 0 || w[0].id[i] > w[0].id[i - 1]));
        assert_memory_equal(&w[0].particle[i].x, &w[1].particle[i].x, sizeof(dem_vec));
    }
    free(bytes);
    dem_free(&w[0]), dem_free(&w[1]), dem_free(&start);
}

/* Many contacts lie in sections, for threads: nothing outside shows where, and particles taken out in between do
   not change it. */
static void test_sections_of_contacts(void **state) {
    (void)state;
    uint64_t hash[4];
    dem_vec pushed[4][3];
    for (int k = 0; k < 4; k++) {
        static const int skip[] = {DEM_SKIP_ALL, DEM_SKIP_ALL, DEM_SKIP_PAIRS, DEM_SKIP_SPACE},
                         threads[] = {1, 3, 1, 2};
        const double part = 0.3 * scene_duration(SCENE_DEEP);
        dem_world w;
        assert_int_equal(scene_make(&w, SCENE_DEEP, skip[k], threads[k], NULL), DEM_OK);
        if (k == 2) w.def.skin = 0.2; /* lists at other times */
        run(&w, part, scene_features(SCENE_DEEP));
        /* or the scene is too small for this test */
        const int sections = w.engine->contacts.chunk_count;
        assert_true(sections >= 16 && w.engine->pairs.timers.pages > 16);
        pushed[k][0] = w.wall[0].force, pushed[k][1] = w.wall[0].torque, pushed[k][2] = w.wall[0].impulse;
        assert_memory_equal(pushed[k], pushed[0], sizeof pushed[0]);
        assert_true(pushed[0][0].z < 0.0);
        for (ptrdiff_t i = 0; i < w.count; i += i < 2000 ? 3 : 50) {
            if (w.alive[i]) assert_int_equal(dem_remove(&w, i), DEM_OK);
        }
        if (k == 2) w.def.threads = 2;
        for (int q = 0; q < w.engine->contacts.chunk_count; q += 3)
            /* Full: new ones go into the last. */
            w.engine->contacts.chunk[q].capacity = w.engine->contacts.chunk[q].count;
        run(&w, part, scene_features(SCENE_DEEP));
        assert_int_equal(w.engine->contacts.chunk_count, sections);
        size_t size;
        unsigned char *bytes = saved(&w, &size);
        dem_world copy;
        assert_int_equal(dem_load(&copy, bytes, size, NULL), DEM_OK);
        free(bytes);
        run(&w, part, scene_features(SCENE_DEEP));
        run(&copy, part, scene_features(SCENE_DEEP));
        hash[k] = dem_hash(&w);
        assert_true(dem_hash(&copy) == hash[k] && hash[k] == hash[0]);
        check_sections(&w);
        check_sections(&copy);
        const ptrdiff_t contacts = dem_contact_count(&w);
        int32_t *touching = calloc((size_t)w.count, sizeof *touching);
        assert_true(touching && contacts > 300);
        for (ptrdiff_t c = 0; c < contacts; c++) {
            const dem_contact_info info = dem_get_contact(&w, c);
            assert_true(info.i >= 0 && info.i < w.count && info.j < w.count && fabs(info.gap) < 1e-3);
            touching[info.i]++;
            if (info.j >= 0) touching[info.j]++;
        }
        for (ptrdiff_t i = 0; i < w.count; i++) assert_int_equal(touching[i], w.touching[i]);
        free(touching);
        dem_free(&copy);
        dem_free(&w);
    }
}

/* Pair k of spheres no two of which are alike, on a floor, thrown at each other. */
static void add_unlike_pair(dem_world *w, int k) {
    for (int side = 0; side < 2; side++) {
        const double size = 4e-3 + 3e-5 * (2 * k + side), at[3] = {0.02 * k, side ? 5e-3 : 0.0, 0.5 * size};
        assert_int_equal(dem_add_spheres(w, 1, at, &size, 0, 0), DEM_OK);
        assert_int_equal(dem_set_motion(w, w->count - 1, dem_vec3(0.1, side ? -0.5 : 0.5, -0.1), dem_vec3(1, 2, 3)),
                         DEM_OK);
    }
}

/* More kinds of contacts than the table holds, in one world: each pair does what it does alone, to the bit. */
static void test_more_kinds_than_the_table_holds(void **state) {
    (void)state;
    enum { PAIRS = 2 * DEM__TYPES_MAX };
    const int features = DEM_HERTZ | DEM_FRICTION | DEM_ROLLING;
    const dem_def def = scene_def(2e-6);
    dem_world all;
    assert_int_equal(dem_init(&all, &def, NULL), DEM_OK);
    assert_true(dem_add_plane(&all, 1, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) >= 0);
    for (int k = 0; k < PAIRS; k++) add_unlike_pair(&all, k);
    run(&all, 0.01, features);
    assert_true(all.engine->contacts.type_count > DEM__TYPES_MAX);
    for (int k = 0; k < PAIRS; k++) {
        dem_world alone;
        assert_int_equal(dem_init(&alone, &def, NULL), DEM_OK);
        assert_true(dem_add_plane(&alone, 1, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) >= 0);
        add_unlike_pair(&alone, k);
        run(&alone, 0.01, features);
        assert_true(alone.engine->contacts.type_count > 0 && alone.engine->contacts.type_count <= 3);
        for (int side = 0; side < 2; side++) {
            const dem_vec x[2] = {dem_position(&alone, side), dem_position(&all, 2 * k + side)};
            const dem_vec v[2] = {dem_velocity(&alone, side), dem_velocity(&all, 2 * k + side)};
            assert_memory_equal(&x[0], &x[1], sizeof x[0]);
            assert_memory_equal(&v[0], &v[1], sizeof v[0]);
            assert_true((side ? -1.0 : 1.0) * v[0].y < 0.0); /* they have met */
        }
        dem_free(&alone);
    }
    dem_free(&all);
}

/* Spheres that gravity and collisions make faster and slower, within shaken cylinders and against them, some near the
   axis: the same bits as if each looked at each wall in every step. */
static void test_round_walls_are_not_missed(void **state) {
    (void)state;
    for (int trial = 0; trial < 12; trial++) {
        uint64_t hash[2];
        int64_t looks[2];
        for (int k = 0; k < 2; k++) {
            dem_world w;
            scene_random r = {(uint64_t)trial + 300};
            dem_def def = scene_def(8e-6);
            def.skip = k ? DEM_SKIP_ALL : 0;
            def.gravity = scene_vector(&r, 60.0);
            start(&w, &def);
            const dem_vec axis = scene_vector(&r, 1.0);
            const int shell = dem_add_cylinder(&w, 1, zero, axis, 0.04, 1),
                      rod = dem_add_cylinder(&w, 1, zero, axis, 0.004, 0);
            assert_int_equal(dem_vibrate(&w, shell, scene_vector(&r, 1e-3), scene_vector(&r, 3.0), 60.0), DEM_OK);
            if (trial % 2)
                assert_int_equal(dem_vibrate(&w, rod, scene_vector(&r, 1e-3), scene_vector(&r, 3.0), 40.0), DEM_OK);
            for (int i = 0; i < 60; i++) {
                const dem_vec across = scene_vector(&r, 1.0), along = scene_vector(&r, 1.0);
                const double length = sqrt(axis.x * axis.x + axis.y * axis.y + axis.z * axis.z);
                const dem_vec n = v3(axis.x / length, axis.y / length, axis.z / length);
                dem_vec side = v3(n.y * across.z - n.z * across.y, n.z * across.x - n.x * across.z,
                                  n.x * across.y - n.y * across.x);
                const double scale =
                    scene_between(&r, 0.007, 0.037) / sqrt(side.x * side.x + side.y * side.y + side.z * side.z);
                const dem_vec at = v3(scale * side.x + 0.1 * along.x * n.x, scale * side.y + 0.1 * along.x * n.y,
                                      scale * side.z + 0.1 * along.x * n.z);
                add(&w, at, 4e-3);
                move(&w, i, scene_vector(&r, i % 3 ? 0.3 : 3.0), zero);
            }
            run(&w, 0.04, DEM_LINEAR | DEM_FRICTION);
            hash[k] = dem_hash(&w), looks[k] = w.looks;
            dem_free(&w);
        }
        assert_true(hash[0] == hash[1]);
        assert_true(40 * looks[1] < looks[0]);
    }
}

static void test_save_and_load(void **state) {
    (void)state;
    for (int scene = 0; scene < SCENE_COUNT; scene++) {
        dem_world w, copy;
        double t = scene_duration(scene);
        assert_int_equal(scene_make(&w, scene, DEM_SKIP_ALL, 1, NULL), DEM_OK);
        for (int part = 0; part < 6; part++) { /* 0: before any run; the others at odd times, mostly between rebuilds */
            size_t size;
            unsigned char *bytes = saved(&w, &size), *again;
            assert_int_equal(dem_load(&copy, bytes, size, NULL), DEM_OK);
            assert_true(dem_hash(&copy) == dem_hash(&w) && copy.step == w.step && copy.time == w.time &&
                        copy.passed_count == w.passed_count);
            assert_true(dem_contact_count(&copy) == dem_contact_count(&w) && copy.particle_steps == w.particle_steps);
            for (int k = 0; k < w.walls; k++) {
                dem_apertures a = dem_count_apertures(&w, k), b = dem_count_apertures(&copy, k);
                assert_true(a.free == b.free && a.total == b.total && a.occupied == b.occupied);
            }
            again = malloc(size);
            assert_int_equal(dem_save(&copy, again, size), size);
            assert_memory_equal(bytes, again, size); /* the same bytes come out again */
            run(&w, 0.171 * t, scene_features(scene));
            run(&copy, 0.171 * t, scene_features(scene));
            if (dem_hash(&copy) != dem_hash(&w))
                fail_msg("scene %s, part %d: the loaded world goes another way", scene_name(scene), part);
            assert_int_equal(copy.passed_count, w.passed_count);
            for (ptrdiff_t k = 0; k < w.passed_count; k++)
                assert_true(copy.passed[k].id == w.passed[k].id && copy.passed[k].time == w.passed[k].time);
            free(bytes), free(again);
            dem_free(&w);
            w = copy; /* and on from the copy */
        }
        dem_free(&w);
    }
}

static void test_save_after_changes(void **state) {
    (void)state;
    dem_world w, copy;
    size_t size;
    unsigned char *bytes;
    assert_int_equal(scene_make(&w, SCENE_BED, DEM_SKIP_ALL, 1, NULL), DEM_OK);
    run(&w, 0.009, scene_features(SCENE_BED));
    assert_true(dem_contact_count(&w) > 100);
    dem_contact_info c = dem_get_contact(&w, 50);
    assert_int_equal(dem_remove(&w, c.i), DEM_OK); /* in contact */
    assert_int_equal(dem_remove(&w, c.i), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_enable_wall(&w, 0, 0), DEM_OK);
    add(&w, v3(0, 0, 0.2), diameter);
    assert_int_equal(dem_set_load(&w, 5, v3(0, 0, 1e-3), zero), DEM_OK);
    bytes = saved(&w, &size);
    assert_int_equal(dem_load(&copy, bytes, size, NULL), DEM_OK);
    assert_true(dem_hash(&copy) == dem_hash(&w));
    run(&w, 0.003, scene_features(SCENE_BED)), run(&copy, 0.003, scene_features(SCENE_BED));
    assert_true(dem_hash(&copy) == dem_hash(&w));
    for (ptrdiff_t i = 0; i < w.count; i++) assert_true(w.id[i] != (uint64_t)c.i || !w.alive[i]);
    free(bytes);
    dem_free(&w), dem_free(&copy);
}

/* FNV-1a over the words, as the file ends: to make damaged files that the checksum lets through. */
static void reseal(unsigned char *bytes, size_t size) {
    uint64_t h = 0xcbf29ce484222325u;
    for (size_t k = 0; k + 8 < size; k++) h = (h ^ bytes[k]) * 0x100000001b3u;
    for (size_t k = 0; k < 8; k++) bytes[size - 8 + k] = (unsigned char)(h >> (8 * k));
}

/* Where the record of a name lies in a saved world, and its bytes, head and all. */
static size_t record_of(const unsigned char *bytes, size_t size, const char *name, size_t *length) {
    for (size_t at = 16; at + 8 < size; at += *length) {
        uint64_t entry = 0, count = 0;
        for (int k = 7; k >= 0; k--)
            entry = entry << 8 | bytes[at + 24 + (size_t)k], count = count << 8 | bytes[at + 32 + (size_t)k];
        *length = 40 + (size_t)(entry * count);
        if (strncmp((const char *)bytes + at, name, 24) == 0) return at;
    }
    return 0;
}

/* Saves of other versions: with a record that this one does not know, and without one that it does. */
static void test_records_of_a_save(void **state) {
    (void)state;
    static const char *const optional[] = {"owed",
                                           "skip",
                                           "skin",
                                           "passed_total",
                                           "needs_forces",
                                           "wall.belt",
                                           "wall.motion_start",
                                           "particle.spin",
                                           "particle.load",
                                           "contact.wrench4",
                                           "contact.has_history"};
    static const char *const needed[] = {"dt",          "materials",   "pair.friction",  "wall.kind",  "particle.x",
                                         "particle.id", "contact.gap", "contact.state0", "chunk.count"};
    dem_world w, copy;
    size_t size, length;
    assert_int_equal(scene_make(&w, SCENE_BED, DEM_SKIP_ALL, 1, NULL), DEM_OK);
    run(&w, 0.009, scene_features(SCENE_BED));
    assert_true(dem_contact_count(&w) > 50);
    unsigned char *bytes = saved(&w, &size), *other = malloc(size + 200);
    const size_t middle = record_of(bytes, size, "particle.v", &length), ends[] = {16, middle, size - 8};
    assert_true(middle > 0);
    for (int k = 0; k < 3; k++) { /* an unknown one in front, within and at the end */
        const size_t at = ends[k], added = 40 + 7 * 11;
        memcpy(other, bytes, at), memset(other + at, 0, added), memcpy(other + at + added, bytes + at, size - at);
        memcpy(other + at, "particle.colour", 15), other[at + 24] = 7, other[at + 32] = 11;
        reseal(other, size + added);
        assert_int_equal(dem_load(&copy, other, size + added, NULL), DEM_OK);
        assert_true(dem_hash(&copy) == dem_hash(&w));
        run(&copy, 1e-3, scene_features(SCENE_BED));
        dem_free(&copy);
    }
    for (size_t k = 0; k < sizeof optional / sizeof *optional + sizeof needed / sizeof *needed; k++) {
        const int may = k < sizeof optional / sizeof *optional;
        const char *name = may ? optional[k] : needed[k - sizeof optional / sizeof *optional];
        const size_t at = record_of(bytes, size, name, &length);
        if (at == 0) fail_msg("no record of %s", name);
        memcpy(other, bytes, at), memcpy(other + at, bytes + at + length, size - at - length);
        reseal(other, size - length);
        const dem_status status = dem_load(&copy, other, size - length, NULL);
        if (may ? status != DEM_OK : status == DEM_OK && strcmp(name, "wall.kind") != 0)
            fail_msg("without %s: %s", name, dem_status_text(status));
        if (status == DEM_OK && may) run(&copy, 1e-4, scene_features(SCENE_BED));
        dem_free(&copy);
        memcpy(other, bytes, size), other[at + 24] ^= 24; /* entries of another size */
        reseal(other, size);
        assert_int_equal(dem_load(&copy, other, size, NULL), DEM_BAD_DATA);
    }
    memcpy(other, bytes, size), other[8] = 8; /* the format before records */
    reseal(other, size);
    assert_int_equal(dem_load(&copy, other, size, NULL), DEM_BAD_DATA);
    free(bytes), free(other);
    dem_free(&w);
}

/* Copies a save in which materials and pairs have room for n materials, as older versions wrote it. Returns
   the new size. */
static size_t with_room_for(const unsigned char *bytes, size_t size, int used, int n, unsigned char *to) {
    size_t length, written = 16;
    memcpy(to, bytes, 16);
    for (size_t at = 16; at + 8 < size; at += length) {
        const int of_materials = memcmp(bytes + at, "material.", 9) == 0,
                  of_pairs = memcmp(bytes + at, "pair.", 5) == 0;
        const size_t entry = bytes[at + 24];
        assert_int_equal(record_of(bytes + at - 16, size - at + 16, (const char *)bytes + at, &length), 16);
        memcpy(to + written, bytes + at, length);
        if (of_materials || of_pairs) {
            const int rows = of_pairs ? n : 1, count = rows * n;
            assert_int_equal(length, 40 + entry * (size_t)(of_pairs ? used * used : used));
            to[written + 32] = (unsigned char)count;
            memset(to + written + 40, 0x55, (size_t)count * entry);
            for (int a = 0; a < (of_pairs ? used : 1); a++)
                memcpy(to + written + 40 + (size_t)(a * n) * entry, bytes + at + 40 + (size_t)(a * used) * entry,
                       (size_t)used * entry);
            written += 40 + (size_t)count * entry;
        } else written += length;
    }
    reseal(to, written + 8);
    return written + 8;
}

/* What a save holds does not depend on DEM_MATERIALS_MAX, and saves with a table of 8 x 8 or 12 x 12 pairs load. */
static void test_saved_materials(void **state) {
    (void)state;
    dem_world w, copy;
    size_t size, length;
    assert_int_equal(scene_make(&w, SCENE_BED, DEM_SKIP_ALL, 1, NULL), DEM_OK);
    run(&w, 0.009, scene_features(SCENE_BED));
    const int used = w.def.materials;
    assert_in_range(used, 2, 4);
    unsigned char *bytes = saved(&w, &size), *other = malloc(size + 64 * 12 * 12 * 8), *again = malloc(size);
    run(&w, 1e-3, scene_features(SCENE_BED));
    for (int n = used - 1; n <= 14; n++) {
        if (n < used)
            memcpy(other, bytes, size),
                other[record_of(bytes, size, "materials", &length) + 40] = (unsigned char)(used + 1);
        const size_t other_size = n < used ? size : with_room_for(bytes, size, used, n, other);
        reseal(other, other_size);
        const dem_status status = dem_load(&copy, other, other_size, NULL);
        assert_int_equal(status, n < used ? DEM_BAD_DATA : DEM_OK); /* fewer than the world has: no */
        if (status != DEM_OK) continue;
        assert_true(dem_save(&copy, again, size) == size && memcmp(bytes, again, size) == 0);
        run(&copy, 1e-3, scene_features(SCENE_BED));
        assert_true(dem_hash(&copy) == dem_hash(&w));
        dem_free(&copy);
    }
    free(bytes), free(other), free(again);
    dem_free(&w);
}

/* A save with one number of a record changed, or with a flag that it did not have. Returns what dem_load says. */
static dem_status load_with(const dem_world *w, const char *name, const void *value, size_t bytes_of, dem_world *copy) {
    size_t size, length;
    unsigned char *was = saved(w, &size), *bytes = (unsigned char *)calloc(size + 44, 1);
    assert_non_null(bytes);
    memcpy(bytes, was, size), free(was);
    size_t at = record_of(bytes, size, name, &length);
    if (at == 0) { /* what the world does not have is not saved: a flag of four bytes is added */
        at = size - 8, length = 44, size += length;
        memset(bytes + at, 0, length), memcpy(bytes + at, name, strlen(name)), bytes[at + 24] = 4, bytes[at + 32] = 1;
    }
    assert_true(length >= 40 + bytes_of);
    const uint16_t order = 1;
    const int is_little = *(const unsigned char *)&order == 1;
    for (size_t k = 0; k < bytes_of; k++)
        bytes[at + 40 + (is_little ? k : bytes_of - 1 - k)] = ((const unsigned char *)value)[k];
    reseal(bytes, size);
    const dem_status status = dem_load(copy, bytes, size, NULL);
    free(bytes);
    return status;
}

/* A flag that promises an array, and a loop as long as a number says. tests/fuzz/fuzz_dem.c forges every
   other record. */
static void test_saves_that_lie(void **state) {
    (void)state;
    static const unsigned char one = 1;
    dem_world w, copy;
    dem_convex brick;
    const double at[3] = {0.0, 0.0, 0.0};
    const double large[] = {1e9, -1e9, 1e300, -1e300, HUGE_VAL, (double)NAN};
    dem_def def = one_material(0.5, 0.3, 0.0);
    on_plane(&w, &def, 0.0);
    run(&w, 1e-4, DEM_LINEAR | DEM_FRICTION);
    assert_int_equal(dem_contact_count(&w), 1);
    assert_int_equal(load_with(&w, "ledger.counts", &one, 1, &copy), DEM_BAD_DATA);
    assert_int_equal(load_with(&w, "ledger.started", &one, 1, &copy), DEM_BAD_DATA);
    assert_int_equal(load_with(&w, "link.on", &one, 1, &copy), DEM_BAD_DATA); /* with an interval of 0 */
    for (size_t k = 0; k < sizeof large / sizeof *large; k++)
        assert_int_equal(load_with(&w, "owed", &large[k], sizeof large[k], &copy), DEM_BAD_DATA);
    dem_free(&w);
    start(&w, &def);
    assert_int_equal(dem_make_brick(&brick, v3(1e-3, 2e-3, 3e-3), 0.03, NULL), DEM_OK);
    assert_int_equal(dem_add_convex(&w, dem_add_shape(&w, &brick), 1, at, NULL, 0, 0), DEM_OK);
    move(&w, 0, zero, v3(1, 2, 3));
    run(&w, 1e-3, DEM_LINEAR | DEM_FRICTION);
    static const char *const numbers[] = {"body.torque", "body.momentum", "body.moments", "body.v", "particle.x", "dt"};
    for (size_t n = 0; n < sizeof numbers / sizeof *numbers; n++) {
        for (size_t k = 0; k < sizeof large / sizeof *large; k++) {
            const dem_status status = load_with(&w, numbers[n], &large[k], sizeof large[k], &copy);
            if (status != DEM_OK) continue;
            dem_energy(&copy), dem_orientation(&copy, 0), dem_get_body(&copy, 0);
            dem_run(&copy, 0.0, DEM_LINEAR | DEM_FRICTION), dem_run(&copy, 2e-6, DEM_LINEAR | DEM_FRICTION);
            dem_energy(&copy), dem_orientation(&copy, 0);
            dem_free(&copy);
        }
    }
    dem_free(&w);
}

static void test_damaged_saves(void **state) {
    (void)state;
    dem_world w, copy;
    size_t size;
    scene_random r = {77};
    long refused = 0, ran = 0;
    assert_int_equal(scene_make(&w, SCENE_SCREEN, DEM_SKIP_ALL, 1, NULL), DEM_OK);
    run(&w, 0.06, scene_features(SCENE_SCREEN));
    assert_true(w.passed_count > 0 && dem_contact_count(&w) > 5);
    unsigned char *bytes = saved(&w, &size), *bad = malloc(size + 16);
    dem_world old = w; /* a count that cannot go on */
    old.particle_steps = INT64_MAX;
    assert_int_equal(dem_save(&old, bad, size), size);
    assert_int_equal(dem_load(&copy, bad, size, NULL), DEM_BAD_DATA);
    for (size_t cut = 0; cut < size; cut += cut < 4000 ? 1 : 97)
        assert_int_equal(dem_load(&copy, bytes, cut, NULL), DEM_BAD_DATA);
    memcpy(bad, bytes, size), memset(bad + size, 0, 16);
    assert_int_equal(dem_load(&copy, bad, size + 8, NULL), DEM_BAD_DATA);
    for (size_t k = 0; k < 1500; k++) { /* one flipped bit */
        memcpy(bad, bytes, size);
        bad[k < 700 ? k : (size_t)(scene_uniform(&r) * (double)size)] ^=
            (unsigned char)(1u << (unsigned)(8.0 * scene_uniform(&r)));
        assert_int_equal(dem_load(&copy, bad, size, NULL), DEM_BAD_DATA);
        dem_free(&copy); /* safe after a refusal */
    }
    for (int k = 0; k < 1500; k++) { /* damage with a right checksum: refused, or a world that runs or says why not */
        memcpy(bad, bytes, size);
        size_t at = 8 * (size_t)(scene_uniform(&r) * (k % 2 ? 1500.0 : (double)(size / 8 - 1)));
        for (int b = 0; b < 8; b++)
            bad[at + (size_t)b] = k % 5 == 0   ? 0xFF
                                  : k % 5 == 1 ? 0
                                  : k % 5 == 2 ? (unsigned char)(b == 7 ? 0x7F : 0xF0)
                                               : (unsigned char)(256.0 * scene_uniform(&r));
        reseal(bad, size);
        dem_status status = dem_load(&copy, bad, size, NULL);
        if (status == DEM_OK) {
            dem_run(&copy, 4e-5, scene_features(SCENE_SCREEN));
            dem_count_apertures(&copy, 0);
            dem_hash(&copy);
            ran++;
        } else {
            assert_true(status == DEM_BAD_DATA || status == DEM_OUT_OF_MEMORY);
            refused++;
        }
        dem_free(&copy);
    }
    print_message("forged saves: %ld refused, %ld ran\n", refused, ran);
    assert_true(refused > 100 && ran > 100);
    assert_int_equal(dem_load(&copy, NULL, size, NULL), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_load(NULL, bytes, size, NULL), DEM_BAD_ARGUMENT);
    free(bad), free(bytes);
    dem_free(&w);
}

/* ---- hostile input ---- */

static void refused(dem_def def, const char *wanted) {
    dem_world w;
    const char *field = NULL;
    assert_int_equal(dem_check_def(&def, &field), DEM_BAD_DEFINITION);
    if (!field || strcmp(field, wanted)) fail_msg("names %s, not %s", field ? field : "nothing", wanted);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_BAD_DEFINITION);
    dem_free(&w);
}

static void test_bad_definitions(void **state) {
    (void)state;
    const dem_def good = one_material(0.5, 0.3, 0.0);
    dem_def d;
    const char *field = "x";
    assert_int_equal(dem_check_def(&good, &field), DEM_OK);
    assert_null(field);
    assert_int_equal(dem_check_def(&good, NULL), DEM_OK);
    assert_int_equal(dem_check_def(NULL, &field), DEM_BAD_DEFINITION);
    assert_string_equal(field, "def");
    assert_int_equal(dem_init(NULL, &good, &field), DEM_BAD_ARGUMENT);
    assert_string_equal(field, "world");
    memset(&d, 0, sizeof d);
    refused(d, "cookie");
    refused(dem_default_def(), "materials");
#define TRY(member, value, name) d = good, d.member = value, refused(d, name)
    TRY(materials, -1, "materials"), TRY(materials, DEM_MATERIALS_MAX + 1, "materials"),
        TRY(materials, 2, "material.density");
    TRY(threads, 0, "threads"), TRY(threads, -5, "threads"), TRY(threads, 1000000, "threads"), TRY(skip, -1, "skip"),
        TRY(skip, 64, "skip");
    static const double bad[] = {0.0, -1.0, (double)NAN, (double)INFINITY, -(double)INFINITY};
    for (int k = 0; k < 5; k++) {
        TRY(dt, bad[k], "dt"), TRY(skin, bad[k], "skin"), TRY(material[0].density, bad[k], "material.density"),
            TRY(material[0].young_modulus, bad[k], "material.young_modulus");
        TRY(pair[0][0].stiffness, bad[k], "pair.stiffness"), TRY(pair[0][0].restitution, bad[k], "pair.restitution");
        if (k == 0) continue; /* zero is a number like any other below */
        TRY(material[0].poisson_ratio, bad[k], "material.poisson_ratio"),
            TRY(pair[0][0].tangential_ratio, bad[k], "pair.tangential_ratio");
        TRY(pair[0][0].friction, bad[k], "pair.friction"), TRY(pair[0][0].rolling, bad[k], "pair.rolling"),
            TRY(pair[0][0].tangential_damping, bad[k], "pair.tangential_damping");
        if (k > 1) TRY(gravity.y, bad[k], "gravity");
        d = good, d.periodic[1] = 1, d.high.y = bad[k], refused(d, "high");
    }
    TRY(pair[0][0].restitution, 1.01, "pair.restitution"),
        TRY(material[0].poisson_ratio, 0.51, "material.poisson_ratio"),
        TRY(pair[0][0].tangential_ratio, 1.1, "pair.tangential_ratio");
    TRY(periodic[2], 2, "periodic"), TRY(allocator.fn, NULL, "allocator.fn"),
        TRY(pair[0][0].mode, (dem_restitution)7, "pair.mode");
#undef TRY
    d = dem_default_def();
    for (int k = 0; k < DEM_MATERIALS_MAX; k++) assert_int_equal(dem_add_material(&d, 1, 1, 0), k);
    assert_int_equal(dem_add_material(&d, 1, 1, 0), -1);
    assert_int_equal(dem_add_material(NULL, 1, 1, 0), -1);
    assert_null(dem_pair(&d, -1, 0)), assert_null(dem_pair(&d, 0, DEM_MATERIALS_MAX)),
        assert_null(dem_pair(NULL, 0, 0));
    assert_ptr_equal(dem_pair(&d, 2, 5), dem_pair(&d, 5, 2));
    assert_int_equal(dem_init(NULL, &good, NULL), DEM_BAD_ARGUMENT);
    for (int k = -2; k < DEM_STATUS_COUNT + 3; k++) assert_true(strlen(dem_status_text((dem_status)k)) > 1);
    assert_int_equal(dem_build_is_deterministic(), 1);
}

static void test_hostile_calls(void **state) {
    (void)state;
    dem_world w, nobody;
    dem_def def = one_material(0.5, 0.3, 0.0);
    double c[3] = {0, 0, 1}, d = 5e-3;
    const double bad[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    memset(&nobody, 0, sizeof nobody);
    start(&w, &def);
    for (int k = 0; k < 2; k++) { /* a world that never was: NULL, and one of zeros */
        dem_world *none = k ? &nobody : NULL;
        dem_screen s = dem_default_screen();
        dem_free(none);
        assert_int_equal(dem_add_spheres(none, 1, c, &d, 0, 0), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_set_motion(none, 0, zero, zero), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_set_load(none, 0, zero, zero), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_remove(none, 0), DEM_BAD_ARGUMENT);
        assert_true(dem_add_plane(none, 0, zero, up) < 0 && dem_add_cylinder(none, 0, zero, up, 1, 1) < 0 &&
                    dem_add_screen(none, 0, &s) < 0);
        assert_true(dem_add_exit(none, zero, up) < 0);
        assert_int_equal(dem_vibrate(none, 0, zero, zero, 1), DEM_BAD_ARGUMENT),
            assert_int_equal(dem_move(none, 0, zero), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_rotate(none, 0, zero, up, 1), DEM_BAD_ARGUMENT),
            assert_int_equal(dem_enable_wall(none, 0, 1), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_run(none, 1.0, DEM_LINEAR), DEM_BAD_ARGUMENT),
            assert_int_equal(dem_set_time_step(none, 1e-6), DEM_BAD_ARGUMENT);
        assert_true(isnan(dem_position(none, 0).x) && isnan(dem_velocity(none, 0).z) && dem_momentum(none).x == 0.0 &&
                    dem_energy(none).kinetic == 0.0);
        assert_true(dem_contact_count(none) == 0 && isnan(dem_get_contact(none, 0).gap) &&
                    dem_count_apertures(none, 0).total == 0);
        assert_true(dem_save(none, NULL, 0) == 0);
        dem_hash(none);
        assert_true(isnan(dem_advise(none, DEM_LINEAR, 1.0).advised));
    }
    assert_int_equal(dem_add_spheres(&w, -1, c, &d, 0, 0), DEM_BAD_ARGUMENT),
        assert_int_equal(dem_add_spheres(&w, 1, NULL, &d, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_spheres(&w, 1, c, NULL, 0, 0), DEM_BAD_ARGUMENT),
        assert_int_equal(dem_add_spheres(&w, 0, NULL, NULL, 0, 0), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 1, c, &d, 1, 0), DEM_BAD_ARGUMENT),
        assert_int_equal(dem_add_spheres(&w, 1, c, &d, -1, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_spheres(&w, PTRDIFF_MAX, c, &d, 0, 0), DEM_TOO_MANY),
        assert_int_equal(dem_add_spheres(&w, INT32_MAX, c, &d, 0, 0), DEM_TOO_MANY);
    static const double bad_d[] = {0.0, -1e-3, 1e-300, 1e200, (double)NAN, (double)INFINITY};
    for (int k = 0; k < 6; k++) assert_int_equal(dem_add_spheres(&w, 1, c, &bad_d[k], 0, 0), DEM_BAD_ARGUMENT);
    for (int k = 0; k < 9; k++) {
        double at[3] = {0, 0, 0};
        at[k % 3] = bad[k / 3];
        assert_int_equal(dem_add_spheres(&w, 1, at, &d, 0, 0), DEM_BAD_ARGUMENT);
    }
    assert_int_equal(w.count, 0);
    add(&w, v3(0, 0, 1), d), add(&w, v3(0, 0, 1.0051), d);
    for (int k = 0; k < 3; k++) {
        dem_vec b = v3(0, bad[k], 0);
        assert_int_equal(dem_set_motion(&w, 0, b, zero), DEM_BAD_ARGUMENT),
            assert_int_equal(dem_set_motion(&w, 0, zero, b), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_set_load(&w, 0, b, zero), DEM_BAD_ARGUMENT),
            assert_int_equal(dem_set_load(&w, 0, zero, b), DEM_BAD_ARGUMENT);
        assert_true(dem_add_plane(&w, 0, b, up) < 0 && dem_add_plane(&w, 0, zero, b) < 0 &&
                    dem_add_exit(&w, b, up) < 0 && dem_add_exit(&w, zero, b) < 0);
        assert_true(dem_add_cylinder(&w, 0, b, up, 1, 1) < 0 && dem_add_cylinder(&w, 0, zero, b, 1, 1) < 0 &&
                    dem_add_cylinder(&w, 0, zero, up, bad[k], 1) < 0);
    }
    assert_int_equal(dem_set_motion(&w, 2, zero, zero), DEM_BAD_ARGUMENT),
        assert_int_equal(dem_set_motion(&w, -1, zero, zero), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_load(&w, 2, zero, zero), DEM_BAD_ARGUMENT),
        assert_int_equal(dem_remove(&w, 2), DEM_BAD_ARGUMENT);
    assert_int_equal(-dem_add_plane(&w, 1, zero, up), DEM_BAD_ARGUMENT),
        assert_int_equal(-dem_add_plane(&w, -1, zero, up), DEM_BAD_ARGUMENT);
    assert_true(dem_add_plane(&w, 0, zero, zero) < 0 && dem_add_cylinder(&w, 0, zero, zero, 1, 1) < 0 &&
                dem_add_cylinder(&w, 0, zero, up, 0.0, 1) < 0 && dem_add_cylinder(&w, 0, zero, up, -1.0, 0) < 0);
    assert_true(dem_add_plane(&w, 0, zero, v3(1e-300, 0, 0)) < 0 || w.walls == 1);
    w.walls = 0;
    dem_screen s = dem_default_screen();
    assert_true(dem_add_screen(&w, 0, NULL) < 0 && dem_add_screen(&w, 9, &s) < 0);
#define TRY(member, value) s = dem_default_screen(), s.member = value, assert_true(dem_add_screen(&w, 0, &s) < 0)
    for (int k = 0; k < 3; k++) {
        TRY(aperture, bad[k]), TRY(wire, bad[k]), TRY(half_x, bad[k]), TRY(centre.x, bad[k]), TRY(normal.y, bad[k]),
            TRY(direction.z, bad[k]);
        s = dem_default_screen(), s.circular = 0, s.half_y = bad[k];
        assert_true(dem_add_screen(&w, 0, &s) < 0);
    }
    TRY(aperture, 0.0), TRY(wire, -1.0), TRY(half_x, 1e300), TRY(half_x, 200.0), TRY(profile, (dem_profile)5),
        TRY(normal, zero);
#undef TRY
    int p = dem_add_plane(&w, 0, zero, up), n = 0;
    assert_true(p == 0);
    static const int wrong[] = {-1, 1, DEM_WALLS_MAX, 1 << 30, -(1 << 30)};
    for (int k = 0; k < 5; k++) {
        assert_int_equal(dem_vibrate(&w, wrong[k], zero, zero, 1), DEM_BAD_ARGUMENT),
            assert_int_equal(dem_move(&w, wrong[k], zero), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_rotate(&w, wrong[k], zero, up, 1), DEM_BAD_ARGUMENT),
            assert_int_equal(dem_enable_wall(&w, wrong[k], 0), DEM_BAD_ARGUMENT);
    }
    for (int k = 0; k < 3; k++) {
        dem_vec b = v3(0, 0, bad[k]);
        assert_int_equal(dem_vibrate(&w, p, b, zero, 1), DEM_BAD_ARGUMENT),
            assert_int_equal(dem_vibrate(&w, p, zero, b, 1), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_vibrate(&w, p, zero, zero, bad[k]), DEM_BAD_ARGUMENT),
            assert_int_equal(dem_move(&w, p, b), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_rotate(&w, p, b, up, 1), DEM_BAD_ARGUMENT),
            assert_int_equal(dem_rotate(&w, p, zero, b, 1), DEM_BAD_ARGUMENT),
            assert_int_equal(dem_rotate(&w, p, zero, up, bad[k]), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_run(&w, bad[k], DEM_LINEAR), DEM_BAD_ARGUMENT),
            assert_int_equal(dem_set_time_step(&w, bad[k]), DEM_BAD_ARGUMENT);
    }
    assert_int_equal(dem_rotate(&w, p, zero, zero, 1), DEM_BAD_ARGUMENT),
        assert_int_equal(dem_vibrate(&w, p, zero, zero, -1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_time_step(&w, 0.0), DEM_BAD_ARGUMENT),
        assert_int_equal(dem_set_time_step(&w, -1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_run(&w, -1e-9, DEM_LINEAR), DEM_BAD_ARGUMENT),
        assert_int_equal(dem_run(&w, 1e300, DEM_LINEAR), DEM_BAD_ARGUMENT);
    static const int odd[] = {0,       DEM_FRICTION, DEM_LINEAR | DEM_HERTZ, DEM_LINEAR | DEM_ROLLING, DEM_ENERGY, 64,
                              1 << 20, -1,           DEM_LINEAR | 128};
    for (size_t k = 0; k < sizeof odd / sizeof *odd; k++) assert_int_equal(dem_run(&w, 1e-5, odd[k]), DEM_BAD_ARGUMENT);
    dem_law law = law_sticky;
    dem_kernel kernel = kernel_sticky;
    kernel.law = NULL;
    assert_int_equal(dem_run_law(&w, 1e-5, &kernel), DEM_BAD_ARGUMENT),
        assert_int_equal(dem_run_law(&w, 1e-5, NULL), DEM_BAD_ARGUMENT);
    kernel = kernel_sticky, kernel.loop = NULL;
    assert_int_equal(dem_run_law(&w, 1e-5, &kernel), DEM_BAD_ARGUMENT);
    kernel = kernel_sticky, kernel.features |= DEM_ENERGY;
    assert_int_equal(dem_run_law(&w, 1e-5, &kernel), DEM_BAD_ARGUMENT);
    kernel = kernel_sticky, kernel.law = &law;
    law.states = DEM_STATE_MAX + 1;
    assert_int_equal(dem_run_law(&w, 1e-5, &kernel), DEM_BAD_ARGUMENT);
    law.states = 2;
    assert_int_equal(dem_run_law(&w, 1e-5, &kernel), DEM_BAD_ARGUMENT);
    law = law_sticky, law.force = NULL;
    assert_int_equal(dem_run_law(&w, 1e-5, &kernel), DEM_BAD_ARGUMENT);
    law = law_sticky, law.prepare = NULL;
    assert_int_equal(dem_run_law(&w, 1e-5, &kernel), DEM_BAD_ARGUMENT);
    assert_true(isnan(dem_position(&w, 2).x) && isnan(dem_position(&w, -1).x) && isnan(dem_get_contact(&w, 5).gap) &&
                isnan(dem_get_contact(&w, -1).gap));
    while (dem_add_plane(&w, 0, v3(0, 0, -1), up) >= 0) n++;
    assert_int_equal(n, DEM_WALLS_MAX - 1);
    assert_int_equal(-dem_add_exit(&w, zero, up), DEM_TOO_MANY);
    run(&w, 1e-4, DEM_LINEAR); /* after all that, it runs */
    dem_free(&w);
    dem_free(&w);
}

static void test_law_mismatch(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.5, 0.3, 0.0);
    on_plane(&w, &def, 0.0);
    run(&w, 1e-4, DEM_LINEAR);
    assert_int_equal(dem_contact_count(&w), 1);
    assert_int_equal(dem_run(&w, 1e-4, DEM_LINEAR | DEM_FRICTION), DEM_LAW_MISMATCH);
    run(&w, 1e-4, DEM_LINEAR); /* the world is as it was */
    move(&w, 0, v3(0, 0, 5), zero);
    run(&w, 1e-3, DEM_LINEAR);
    run(&w, 1e-4, DEM_LINEAR | DEM_FRICTION); /* in flight there is no history to lose */
    run(&w, 1e-4, DEM_LINEAR);
    for (int a = 0; a < 3; a++) assert_null(w.engine->contacts.state[a]); /* nothing of a block that is gone */
    run(&w, 1e-4, DEM_HERTZ | DEM_FRICTION);
    dem_free(&w);
}

/* Copies a save without one of its records. Returns the new size. */
static size_t without_record(const unsigned char *bytes, size_t size, const char *name, unsigned char *to) {
    size_t length;
    const size_t at = record_of(bytes, size, name, &length);
    assert_true(at > 0);
    memcpy(to, bytes, at), memcpy(to + at, bytes + at + length, size - at - length);
    reseal(to, size - length);
    return size - length;
}

/* Four states, as Hertz-Mindlin has them, that mean something else: Luding's keeps the largest overlap. */
DEM_INLINE void force_luding(const dem_contact *c, double *state, dem_response *r) {
    dem_force_linear_friction(c, state, r);
    if (-c->gap > state[3]) state[3] = -c->gap;
    r->normal *= 1.0 + 100.0 * state[3];
}
static const dem_law law_luding = {"Luding",     1,    4,   4, 1, DEM_LINEAR_CONSTANTS, dem_prepare_linear,
                                   force_luding, NULL, NULL};
DEM_KERNEL(kernel_luding, law_luding, DEM_LINEAR | DEM_FRICTION)

/* A law that keeps as many states as another one does not go on with them: not in a run, not after loading. */
static void test_law_has_a_name(void **state) {
    (void)state;
    static const char long_name[] =
        "a law with a name that is much longer than any record of a save would hold in its head";
    char longer[sizeof long_name + 1] = "";
    const struct {
        const char *name;
        int version, fits;
    } other[] = {{"Luding", 1, 1},        {"Luding, hysteretic", 1, 1}, {"Luding", 2, 0},     {"Luding", -1, 0},
                 {"Luding hysteretic", 1, 0}, {"luding", 1, 0},         {"", 1, 0},           {"Lu,ding", 1, 0},
                 {NULL, 1, 1},            {NULL, 2, 1},                 {long_name, 1, 0}};
    dem_world w, copy;
    dem_def def = one_material(0.5, 0.3, 0.0);
    def.material[0].young_modulus = 1e7;
    on_plane(&w, &def, 0.0);
    assert_int_equal(dem_run_law(&w, 1e-3, &kernel_luding), DEM_OK);
    assert_int_equal(dem_contact_count(&w), 1);
    assert_true(dem_get_contact(&w, 0).state[3] > 0.0);
    size_t size;
    unsigned char *bytes = saved(&w, &size), *old = malloc(size);
    const size_t old_size = without_record(bytes, size, "contact.law", old);
    /* in the session, from a save, from a save that does not say whose it is */
    for (int loads = 0; loads < 3; loads++) {
        for (size_t k = 0; k <= sizeof other / sizeof *other; k++) {
            dem_kernel kernel = kernel_luding;
            dem_law law = law_luding;
            const int is_hertz = k == sizeof other / sizeof *other;
            if (!is_hertz) law.name = other[k].name, law.version = other[k].version;
            kernel.law = &law;
            if (loads == 2) assert_int_equal(dem_load(&copy, old, old_size, NULL), DEM_OK);
            else assert_int_equal(dem_load(&copy, bytes, size, NULL), DEM_OK);
            if (loads == 0) assert_int_equal(dem_run_law(&copy, 1e-4, &kernel_luding), DEM_OK);
            const uint64_t before = dem_hash(&copy);
            const dem_status status =
                is_hertz ? dem_run(&copy, 1e-4, DEM_HERTZ | DEM_FRICTION) : dem_run_law(&copy, 1e-4, &kernel);
            const int fits = loads == 2 || (!is_hertz && other[k].fits);
            if (status != (fits ? DEM_OK : DEM_LAW_MISMATCH))
                fail_msg("law %d, case %d: %s", (int)k, loads, dem_status_text(status));
            if (!fits) assert_true(dem_hash(&copy) == before && dem_run_law(&copy, 1e-4, &kernel_luding) == DEM_OK);
            dem_free(&copy);
        }
    }
    assert_int_equal(dem_load(&copy, bytes, size, NULL), DEM_OK);
    assert_int_equal(dem_run_law(&copy, 1e-3, &kernel_luding), DEM_OK);
    assert_int_equal(dem_run_law(&w, 1e-3, &kernel_luding), DEM_OK);
    assert_true(dem_hash(&w) == dem_hash(&copy));
    dem_free(&copy), dem_free(&w), free(bytes), free(old);

    for (int k = 0; k < 2; k++) { /* long names that differ in their last character */
        dem_kernel kernel = kernel_luding;
        dem_law law = law_luding;
        memcpy(longer, long_name, sizeof long_name);
        law.name = longer, kernel.law = &law;
        on_plane(&w, &def, 0.0);
        assert_int_equal(dem_run_law(&w, 1e-3, &kernel), DEM_OK);
        bytes = saved(&w, &size);
        assert_int_equal(dem_load(&copy, bytes, size, NULL), DEM_OK);
        longer[sizeof long_name - 2] = k ? 'd' : 'c';
        assert_int_equal(dem_run_law(&copy, 1e-4, &kernel), k ? DEM_OK : DEM_LAW_MISMATCH);
        dem_free(&copy), dem_free(&w), free(bytes);
    }
}

/* The ledger begins, pauses and ends in mid-run: the motion stays the same bits, and what contacts store is there
   from the start. */
static void test_ledger_in_mid_run(void **state) {
    (void)state;
    static const int base[] = {DEM_LINEAR, DEM_LINEAR | DEM_FRICTION, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING,
                               DEM_HERTZ,  DEM_HERTZ | DEM_FRICTION,  DEM_HERTZ | DEM_FRICTION | DEM_ROLLING};
    for (size_t k = 0; k < sizeof base / sizeof *base; k++) {
        dem_world w[2];
        for (int counts = 0; counts < 2; counts++) {
            dem_def def = one_material(0.9, 0.3, 1e-5);
            dem_world *q = &w[counts];
            def.material[0].young_modulus = 1e7;
            def.gravity = v3(0.3, 0, -9.81);
            start(q, &def);
            dem_add_plane(q, 0, zero, up);
            dem_add_plane(q, 0, v3(0, 0, 0.01497), v3(0, 0, -1)); /* three in a squeezed column, which buckles */
            for (int i = 0; i < 3; i++) add(q, v3(1e-4 * i, 0, 2.495e-3 + 4.99e-3 * i), 5e-3);
            run(q, 2e-4, base[k]);
            assert_true(dem_contact_count(q) > 0 && dem_energy(q).elastic == 0.0);
            double error = 0.0;
            for (int part = 0; part < 6; part++) { /* with, with, without, with, without, with */
                const int on = counts && part != 2 && part != 4;
                run(q, 1.5e-4, base[k] | (on ? DEM_ENERGY : 0));
                const dem_energy_ledger l = dem_energy(q);
                if (!counts) continue;
                if (part == 0) assert_true(l.start > l.kinetic); /* the stored part is in it */
                assert_true(on ? l.elastic > 0.0 : l.elastic == 0.0);
                near_absolute(l.error, error, 3e-3 * (fabs(l.start) + l.normal_loss), "error of the ledger");
                error = l.error;
                if (part == 3) { /* the switch goes with a saved world */
                    const size_t size = dem_save(q, NULL, 0);
                    unsigned char *bytes = malloc(size);
                    assert_non_null(bytes);
                    assert_true(dem_save(q, bytes, size) == size);
                    dem_free(q);
                    assert_int_equal(dem_load(q, bytes, size, NULL), DEM_OK);
                    free(bytes);
                    assert_true(dem_energy(q).elastic == l.elastic && dem_energy(q).error == l.error);
                }
            }
        }
        for (int i = 0; i < 3; i++) {
            const dem_vec a = dem_position(&w[0], i), b = dem_position(&w[1], i), c = dem_velocity(&w[0], i),
                          d = dem_velocity(&w[1], i);
            assert_true(a.x == b.x && a.y == b.y && a.z == b.z && c.x == d.x && c.y == d.y && c.z == d.z);
        }
        for (int q = 0; q < 2; q++) dem_free(&w[q]);
    }
}

static void test_failures_name_the_particle(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        dem_world w;
        dem_def def = one_material(0.5, 0.3, 0.0);
        start(&w, &def);
        dem_add_plane(&w, 0, zero, up);
        for (int i = 0; i < 20; i++) add(&w, v3(0.01 * i, 0, 0.1), diameter);
        run(&w, 1e-4, DEM_LINEAR);
        assert_int_equal(dem_remove(&w, 3), DEM_OK); /* so that id and index differ after the next rebuild */
        if (k == 0) assert_int_equal(dem_set_load(&w, 13, v3(1e75, 1e75, 0), zero), DEM_OK);
        if (k == 1) assert_int_equal(dem_set_load(&w, 13, v3(0, 0, 1e6), zero), DEM_OK);
        if (k == 2) move(&w, 13, v3(1e4, 0, 0), zero);
        dem_status status = dem_run(&w, 0.01, DEM_LINEAR);
        assert_true(k == 0 ? status == DEM_NOT_FINITE || status == DEM_TOO_FAST : status == DEM_TOO_FAST);
        assert_int_equal(w.status, status);
        assert_int_equal(w.failed_id, 13);
        assert_in_range(w.step, 25, 100);
        assert_int_equal(dem_run(&w, 0.01, DEM_LINEAR), status); /* it stays so */
        size_t size;
        unsigned char *bytes = saved(&w, &size);
        dem_hash(&w), dem_energy(&w), dem_momentum(&w);
        free(bytes);
        dem_free(&w);
    }
}

/* ---- memory ---- */

static dem_status everything(failing_allocator *memory) {
    dem_world w, copy;
    dem_allocator hook;
    dem_status status, loaded = DEM_OK;
    hook.fn = failing_fn, hook.user = memory;
    status = scene_make(&w, SCENE_SCREEN, DEM_SKIP_ALL, 1, &hook);
    if (status == DEM_OK) status = dem_run(&w, 0.004, scene_features(SCENE_SCREEN));
    if (status == DEM_OK) status = dem_run(&w, 0.051, scene_features(SCENE_SCREEN) | DEM_ENERGY);
    if (status == DEM_OK) status = dem_run(&w, 0.004, scene_features(SCENE_SCREEN));
    if (status == DEM_OK) assert_true(w.passed_count > 0);
    /* read, save and free, whatever happened */
    dem_energy(&w), dem_momentum(&w);
    if (w.def.allocator.fn) {
        size_t size;
        unsigned char *bytes = saved(&w, &size);
        for (ptrdiff_t c = 0; c < dem_contact_count(&w); c++) assert_true(dem_get_contact(&w, c).i < w.count);
        for (int k = 0; k < w.walls; k++) dem_count_apertures(&w, k);
        loaded = dem_load(&copy, bytes, size, &hook);
        if (loaded == DEM_BAD_DATA)
            fail_msg("a world that ran out of memory at %d left a save that cannot be loaded", memory->fail_at);
        if (loaded == DEM_OK) assert_true(dem_hash(&copy) == dem_hash(&w));
        dem_free(&copy);
        free(bytes);
    }
    dem_free(&w);
    return status != DEM_OK ? status : loaded;
}

static void test_memory_running_out(void **state) {
    (void)state;
    int k = 0, failures = 0;
    for (;; k++) {
        failing_allocator memory;
        failing_init_at(&memory, k);
        dem_status status = everything(&memory);
        assert_int_equal(failing_live(&memory), 0);
        assert_true(status == DEM_OK || status == DEM_OUT_OF_MEMORY);
        failures += status == DEM_OUT_OF_MEMORY;
        if (!memory.has_failed) break;
        assert_true(status == DEM_OUT_OF_MEMORY);
    }
    print_message("%d places where memory can run out\n", k);
    assert_true(failures == k && k >= 8);
    /* a world that ran out for a moment can be saved, loaded and goes on as if nothing had been */
    failing_allocator memory;
    dem_allocator hook;
    dem_world w, reference;
    hook.fn = failing_fn, hook.user = &memory;
    assert_int_equal(scene_make(&reference, SCENE_SCREEN, DEM_SKIP_ALL, 1, NULL), DEM_OK);
    run(&reference, 0.06, scene_features(SCENE_SCREEN));
    for (int fail = 0; fail < k; fail++) {
        failing_init(&memory);
        memory.fail_at = fail, memory.fail_count = 1;
        if (scene_make(&w, SCENE_SCREEN, DEM_SKIP_ALL, 1, &hook) == DEM_OK) {
            while (dem_run(&w, 0.06 - w.time, scene_features(SCENE_SCREEN)) != DEM_OK) {
                size_t size;
                unsigned char *bytes = saved(&w, &size);
                assert_true(memory.has_failed);
                dem_free(&w);
                assert_int_equal(dem_load(&w, bytes, size, &hook), DEM_OK);
                free(bytes);
            }
            assert_true(w.step == reference.step && dem_hash(&w) == dem_hash(&reference) &&
                        w.passed_count == reference.passed_count);
        }
        dem_free(&w);
        assert_int_equal(failing_live(&memory), 0);
    }
    dem_free(&reference);
}

/* ---- several worlds, several laws ---- */

static void test_several_worlds_and_laws(void **state) {
    (void)state;
    uint64_t alone[3], together[3];
    for (int pass = 0; pass < 2; pass++) {
        dem_world w[3];
        dem_def def = one_material(0.7, 0.4, 0.0);
        assert_int_equal(scene_make(&w[0], SCENE_BED, DEM_SKIP_ALL, 1, NULL), DEM_OK);
        assert_int_equal(scene_make(&w[1], SCENE_PERIODIC, DEM_SKIP_ALL, 1, NULL), DEM_OK);
        def.gravity = zero;
        start(&w[2], &def);
        scene_random r = {9};
        assert_int_equal(scene_fill(&w[2], &r, 3, 3, 3, v3(0, 0, 0), 5.2e-3, &diameter, 1, 0.05), DEM_OK);
        int parts = pass ? 10 : 1;
        for (int k = 0; k < parts; k++) {
            for (int q = 0; q < 2; q++) run(&w[q], 0.006 / parts, scene_features(q ? SCENE_PERIODIC : SCENE_BED));
            assert_int_equal(dem_run_law(&w[2], 0.02 / parts, &kernel_sticky), DEM_OK);
        }
        for (int q = 0; q < 3; q++) (pass ? together : alone)[q] = dem_hash(&w[q]), dem_free(&w[q]);
    }
    for (int q = 0; q < 3; q++) assert_true(alone[q] == together[q]);
    /* the attraction of the second law is there: the same pair holds together with it and parts without it */
    for (int sticky = 0; sticky < 2; sticky++) {
        dem_world w;
        dem_def def = one_material(0.7, 0.4, 0.0);
        def.gravity = zero;
        start(&w, &def);
        add(&w, zero, diameter), add(&w, v3(0, 0, diameter - 1e-7), diameter);
        move(&w, 1, v3(0, 0, 2e-4), zero);
        assert_int_equal(sticky ? dem_run_law(&w, 0.05, &kernel_sticky) : dem_run(&w, 0.05, DEM_LINEAR | DEM_FRICTION),
                         DEM_OK);
        assert_int_equal(dem_contact_count(&w), sticky);
        dem_free(&w);
    }
}

static void test_empty_worlds(void **state) {
    (void)state;
    dem_world w, copy;
    dem_def def = one_material(0.7, 0.4, 0.0);
    start(&w, &def);
    run(&w, 0.0, DEM_LINEAR), run(&w, 1e-3, DEM_HERTZ | DEM_ENERGY);
    assert_int_equal(w.step, 250);
    assert_int_equal(dem_set_time_step(&w, 1e-5), DEM_OK);
    run(&w, 1e-3, DEM_LINEAR);
    assert_int_equal(w.step, 350);
    near_relative(w.time, 2e-3, 1e-12, "time over two steps");
    size_t size;
    unsigned char *bytes = saved(&w, &size);
    assert_int_equal(dem_load(&copy, bytes, size, NULL), DEM_OK);
    add(&copy, v3(0, 0, 1), diameter);
    run(&copy, 1e-3, DEM_LINEAR);
    assert_int_equal(dem_remove(&copy, 0), DEM_OK);
    run(&copy, 1e-3, DEM_LINEAR);
    assert_int_equal(copy.count - copy.engine->bodies.dropped, 0);
    free(bytes);
    dem_free(&w), dem_free(&copy);
}

/* Remainders of durations carry over: a thousand short runs are one long run. */
static void test_runs_add_up(void **state) {
    (void)state;
    dem_world a, b;
    assert_int_equal(scene_make(&a, SCENE_GAS, DEM_SKIP_ALL, 1, NULL), DEM_OK);
    assert_int_equal(scene_make(&b, SCENE_GAS, DEM_SKIP_ALL, 1, NULL), DEM_OK);
    run(&a, 0.01, DEM_LINEAR);
    for (int k = 0; k < 1000; k++) run(&b, 0.01 / 1000.0, DEM_LINEAR); /* two and a half steps each */
    assert_int_equal(a.step, 2500);
    assert_int_equal(b.step, 2500);
    assert_true(dem_hash(&a) == dem_hash(&b));
    dem_free(&a), dem_free(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_restitution_laws),
        cmocka_unit_test(test_laws_outside_their_domain),
        cmocka_unit_test(test_advice),
        cmocka_unit_test(test_free_flight),
        cmocka_unit_test(test_bowled_ball),
        cmocka_unit_test(test_incline),
        cmocka_unit_test(test_rolling_resistance),
        cmocka_unit_test(test_tangential_dashpot),
        cmocka_unit_test(test_force_of_a_new_contact),
        cmocka_unit_test(test_history_turns_with_the_contact),
        cmocka_unit_test(test_rigid_rotation_is_no_slip),
        cmocka_unit_test(test_binary_collisions_keep_momentum),
        cmocka_unit_test(test_wall_is_an_infinite_mass),
        cmocka_unit_test(test_cylinder),
        cmocka_unit_test(test_wall_carries_weight),
        cmocka_unit_test(test_wall_motions),
        cmocka_unit_test(test_belt),
        cmocka_unit_test(test_screen_geometry),
        cmocka_unit_test(test_ends_of_bars),
        cmocka_unit_test(test_edge_of_a_deck),
        cmocka_unit_test(test_apertures),
        cmocka_unit_test(test_periodic),
        cmocka_unit_test(test_walls_of_a_periodic_box),
        cmocka_unit_test(test_narrow_box),
        cmocka_unit_test(test_far_outside_a_box),
        cmocka_unit_test(test_lists_last),
        cmocka_unit_test(test_exits),
        cmocka_unit_test(test_exit_in_contact),
        cmocka_unit_test(test_enable_wall),
        cmocka_unit_test(test_loads),
        cmocka_unit_test(test_skipping_changes_no_bit),
        cmocka_unit_test(test_ledger_changes_no_bit),
        cmocka_unit_test(test_no_contact_is_missed),
        cmocka_unit_test(test_round_walls_are_not_missed),
        cmocka_unit_test(test_sections_of_contacts),
        cmocka_unit_test(test_order_by_place),
        cmocka_unit_test(test_order_in_memory),
        cmocka_unit_test(test_more_kinds_than_the_table_holds),
        cmocka_unit_test(test_save_and_load),
        cmocka_unit_test(test_save_after_changes),
        cmocka_unit_test(test_records_of_a_save),
        cmocka_unit_test(test_saved_materials),
        cmocka_unit_test(test_saves_that_lie),
        cmocka_unit_test(test_damaged_saves),
        cmocka_unit_test(test_bad_definitions),
        cmocka_unit_test(test_hostile_calls),
        cmocka_unit_test(test_law_mismatch),
        cmocka_unit_test(test_law_has_a_name),
        cmocka_unit_test(test_ledger_in_mid_run),
        cmocka_unit_test(test_failures_name_the_particle),
        cmocka_unit_test(test_memory_running_out),
        cmocka_unit_test(test_several_worlds_and_laws),
        cmocka_unit_test(test_empty_worlds),
        cmocka_unit_test(test_runs_add_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
