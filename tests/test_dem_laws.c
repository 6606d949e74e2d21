/* dem_laws.h: adhesion, rolling, twisting and bonds against closed forms, in the formula and in a running world;
   dem_wet.h: what bridges hold, the books of their liquid. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include "near.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>

#include "dem_laws.h"
#include "dem_scenes.h"
#include "dem_wet.h"
#include "failing_allocator.h"

DEM_KERNEL(kernel_jkr, contact_jkr, DEM_HERTZ | DEM_FRICTION)
DEM_KERNEL(kernel_jkr_energy, contact_jkr, DEM_HERTZ | DEM_FRICTION | DEM_ENERGY)
DEM_KERNEL(kernel_dmt, contact_dmt, DEM_HERTZ | DEM_FRICTION)
DEM_KERNEL(kernel_dmt_energy, contact_dmt, DEM_HERTZ | DEM_FRICTION | DEM_ENERGY)
DEM_KERNEL(kernel_epsd, contact_epsd, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING)
DEM_KERNEL(kernel_epsd_energy, contact_epsd, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY)
DEM_KERNEL(kernel_epsd_hertz, contact_epsd_hertz, DEM_HERTZ | DEM_FRICTION | DEM_ROLLING)
DEM_KERNEL(kernel_epsd_hertz_energy, contact_epsd_hertz, DEM_HERTZ | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY)
DEM_KERNEL(kernel_bonds, contact_bonds, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING)
DEM_KERNEL(kernel_bonds_energy, contact_bonds, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY)

typedef struct use {
    const dem_kernel *kernel, *with_ledger;
} use;
static const use uses[] = {
    {&kernel_jkr, &kernel_jkr_energy},     {&kernel_dmt, &kernel_dmt_energy},
    {&kernel_epsd, &kernel_epsd_energy},   {&kernel_epsd_hertz, &kernel_epsd_hertz_energy},
    {&kernel_bonds, &kernel_bonds_energy},
};
enum { JKR, DMT, EPSD, EPSD_HERTZ, BONDS, USES };

static dem_vec v3(double x, double y, double z) { return dem_vec3(x, y, z); }
static const dem_vec none = {0.0, 0.0, 0.0}, up = {0.0, 0.0, 1.0};

static void start(dem_world *w, const dem_def *def, contact_laws *laws) {
    assert_null(contact_bad_field(laws));
    assert_int_equal(dem_init(w, def, NULL), DEM_OK);
    w->user = laws;
}
static void add(dem_world *w, dem_vec at, double d, int material) {
    assert_int_equal(dem_add_spheres(w, 1, &at.x, &d, material, 0), DEM_OK);
}
static void run(dem_world *w, double t, int which) {
    const use *u = &uses[which];
    const dem_status status = dem_run_law(w, t, u->kernel);
    if (status != DEM_OK)
        fail_msg("%s, particle %lu, step %ld", dem_status_text(status), (unsigned long)w->failed_id, (long)w->step);
}
static void run_with_ledger(dem_world *w, double t, int which) {
    const use *u = &uses[which];
    assert_int_equal(dem_run_law(w, t, u->with_ledger), DEM_OK);
}

/* ---- adhesion: formulas ---- */

/* a powder grain of 20 micrometres: E* = E/(2 (1 - nu^2)) between equals */
static const double R = 1e-5, modulus = 1e8, energy = 0.05, poisson = 0.25, density = 1500.0;

static void test_jkr_formulas(void **state) {
    (void)state;
    const double released = contact_jkr_release(R, modulus, energy), force = contact_jkr_pull_off(R, energy);
    const double unloaded = cbrt(4.5 * RIDDLE_PI * energy * R * R / modulus); /* JKR 1971, at zero force */
    near_relative(force, 1.5 * RIDDLE_PI * energy * R, 1e-15, "pull-off");
    near_relative(released, -0.75 * cbrt(RIDDLE_PI * RIDDLE_PI * energy * energy * R / (modulus * modulus)), 1e-14,
                  "release");
    near_relative(contact_jkr_law(R, modulus, energy, contact_jkr_radius(R, modulus, energy, released)),
                  -5.0 / 9.0 * force, 1e-6, "at release");
    near_relative(contact_jkr_law(R, modulus, energy, contact_jkr_radius(R, modulus, energy, 0.0)), -8.0 / 9.0 * force,
                  1e-14, "at touching");
    near_absolute(contact_jkr_law(R, modulus, energy, unloaded), 0.0, 1e-13 * force, "unloaded");
    near_relative(contact_jkr_radius(R, modulus, energy, unloaded * unloaded / (3.0 * R)), unloaded, 1e-14,
                  "radius, unloaded");
    double least = 0.0, before = 0.0;
    for (int k = 0; k <= 200000; k++) { /* the curve, from release to 100 times as far in */
        const double delta = released + 1e-3 * fabs(released) * k * (k < 1000 ? 1e-3 : 0.5),
                     a = contact_jkr_radius(R, modulus, energy, delta);
        const double f = contact_jkr_law(R, modulus, energy, a);
        near_absolute(a * a / R - sqrt(2.0 * RIDDLE_PI * energy * a / modulus), delta,
                      4e-15 * (a * a / R + fabs(delta)), "overlap");
        assert_true(a > before);
        before = a;
        least = f < least ? f : least;
    }
    near_relative(least, -force, 1e-7, "least force on the curve");
    near_relative(contact_jkr_work(R, modulus, energy), 7.09 * cbrt(pow(energy, 5) * pow(R, 4) / (modulus * modulus)),
                  1e-3, "work: 7.09");
    const double b = cbrt(2.0 * RIDDLE_PI * energy * R * R / modulus);
    double work = 0.0;
    for (int k = 0; k < 100000; k++) { /* the work as a plain sum over the way out */
        const double z = 1.0 - (1.0 - pow(4.0, -2.0 / 3.0)) * (k + 0.5) / 100000.0, a = z * b,
                     s = (1.0 - pow(4.0, -2.0 / 3.0)) * b / 100000.0;
        work -= contact_jkr_law(R, modulus, energy, a) *
                (2.0 * a / R - 0.5 * sqrt(2.0 * RIDDLE_PI * energy / (modulus * a))) * s;
    }
    near_relative(contact_jkr_work(R, modulus, energy), work, 1e-9, "work, summed");
    const double m = 4.0 / 3.0 * RIDDLE_PI * R * R * R * density; /* Thornton & Ning's for a sphere on a wall */
    near_relative(contact_jkr_sticking_speed(R, modulus, energy, m),
                  1.84 * pow(pow(energy / R, 5) / (density * density * density * modulus * modulus), 1.0 / 6.0), 2e-3,
                  "sticking speed");
    near_relative(contact_jkr_radius(R, modulus, 0.0, 1e-7), sqrt(R * 1e-7), 1e-15, "without adhesion: Hertz");
    near_relative(contact_dmt_pull_off(R, energy), 2.0 * RIDDLE_PI * energy * R, 1e-15, "DMT");
}

static void test_formulas_outside_their_domain(void **state) {
    (void)state;
    const double bad[] = {-1.0, (double)NAN, -HUGE_VAL};
    for (int k = 0; k < 3; k++) {
        assert_true(isnan(contact_jkr_pull_off(bad[k], energy)) && isnan(contact_jkr_pull_off(R, bad[k])));
        assert_true(isnan(contact_dmt_pull_off(bad[k], energy)) && isnan(contact_dmt_pull_off(R, bad[k])));
        assert_true(isnan(contact_jkr_release(bad[k], modulus, energy)) &&
                    isnan(contact_jkr_release(R, bad[k], energy)));
        assert_true(isnan(contact_jkr_release(R, modulus, bad[k])) &&
                    isnan(contact_jkr_radius(R, modulus, bad[k], 0.0)));
        assert_true(isnan(contact_jkr_radius(R, modulus, energy, bad[k])) &&
                    isnan(contact_jkr_law(R, modulus, energy, bad[k])));
        assert_true(isnan(contact_jkr_work(bad[k], modulus, energy)) &&
                    isnan(contact_jkr_sticking_speed(R, modulus, energy, bad[k])));
    }
    assert_true(isnan(contact_jkr_radius(R, modulus, energy, 1.000001 * contact_jkr_release(R, modulus, energy))));
    assert_true(isnan(contact_jkr_radius(0.0, modulus, energy, 0.0)) &&
                isnan(contact_jkr_sticking_speed(R, modulus, energy, 0.0)));
    assert_true(isfinite(contact_jkr_radius(1e-300, modulus, 0.0, 0.0)));
}

/* ---- adhesion: in a world ---- */

static contact_laws sticky(double w) {
    contact_laws laws = contact_default_laws();
    contact_pair(&laws, 0, 0)->surface_energy = w;
    return laws;
}
/* Grains without gravity and friction, on the plane z = 0. */
static dem_def grains(double e, double rho) {
    dem_def def = dem_default_def();
    dem_add_material(&def, rho, 2.0 * (1.0 - poisson * poisson) * modulus, poisson);
    dem_pair(&def, 0, 0)->restitution = e;
    dem_pair(&def, 0, 0)->friction = 0.0;
    def.gravity = none;
    return def;
}

/* A grain too heavy to be stopped is drawn off a plane; the plane feels the whole curve. */
static void test_pull_off_force(void **state) {
    (void)state;
    for (int which = JKR; which <= DMT; which++) {
        dem_world w;
        dem_def def = grains(1.0, 1e9);
        contact_laws laws = sticky(energy);
        const double released = which == JKR ? -contact_jkr_release(R, modulus, energy) : 0.0, depth = 2e-8;
        const double wanted = which == JKR ? contact_jkr_pull_off(R, energy) : contact_dmt_pull_off(R, energy);
        const double speed = 1e-2;
        def.dt = depth / speed / 20000.0;
        start(&w, &def, &laws);
        dem_add_plane(&w, 0, none, up);
        add(&w, v3(0, 0, R - depth), 2.0 * R, 0);
        dem_set_motion(&w, 0, v3(0, 0, speed), none);
        double most = 0.0, farthest = 0.0, last = 0.0;
        while (dem_position(&w, 0).z < R + 2.0 * released + 1e-9) {
            run(&w, def.dt, which);
            const double pull = w.wall[0].force.z;
            if (pull > most) most = pull;
            if (pull != 0.0) farthest = dem_position(&w, 0).z - R, last = pull;
        }
        near_relative(most, wanted, 1e-6, "greatest pull on the wall");
        near_absolute(farthest, released, 2.0 * speed * def.dt, "released at");
        if (which == JKR) near_relative(last, 5.0 / 9.0 * wanted, 2e-2, "the last pull");
        assert_int_equal(dem_contact_count(&w), 0);
        near_relative(dem_velocity(&w, 0).z, speed, 1e-3, "too heavy to be stopped");
        dem_free(&w);
    }
}

/* A hanging grain: the load that the contact carries, by bisection. JKR under a load lets go at 1.5 pi w R, not at
   the release. */
static void test_grain_hangs(void **state) {
    (void)state;
    const double force = contact_jkr_pull_off(R, energy);
    for (int k = 0; k < 2; k++) {
        dem_world w;
        dem_def def = grains(0.2, density);
        contact_laws laws = sticky(energy);
        start(&w, &def, &laws);
        dem_add_plane(&w, 0, none, up);
        add(&w, v3(0, 0, R - 1e-10), 2.0 * R, 0);
        dem_set_time_step(&w, 0.5 * dem_advise(&w, DEM_HERTZ, 0.1).advised);
        for (int s = 0; s < 2000; s++) { /* the way to the summit is a square root */
            const double share = 1.0 - (double)(s + 1) / 2000.0;
            dem_set_load(&w, 0, v3(0, 0, (k ? 1.002 : 0.999) * force * (1.0 - share * share / 9.0)), none);
            run(&w, 400.0 * w.def.dt, JKR);
            if (dem_contact_count(&w) == 0) break;
        }
        assert_int_equal(dem_contact_count(&w), k ? 0 : 1);
        dem_free(&w);
    }
}

static double rebound(int which, double speed, double w_, double share) {
    dem_world w;
    dem_def def = grains(1.0, density);
    contact_laws laws = sticky(w_);
    start(&w, &def, &laws);
    dem_add_plane(&w, 0, none, up);
    add(&w, v3(0, 0, R + 1e-8), 2.0 * R, 0);
    dem_set_motion(&w, 0, v3(0, 0, -speed), none);
    /* Hertz. */
    const double tc = 2.943275175395 * pow(25.0 / 16.0 * pow(dem_mass(&w, 0) / modulus, 2) / (R * speed), 0.2);
    dem_set_time_step(&w, share * tc);
    run_with_ledger(&w, 1e-8 / speed + 8.0 * tc, which);
    const dem_energy_ledger l = dem_energy(&w);
    near_absolute(l.error, 0.0, 2.0 * share * l.start, "ledger");
    const double e = dem_contact_count(&w) ? 0.0 : dem_velocity(&w, 0).z / speed;
    dem_free(&w);
    return e;
}

static void test_adhesive_restitution(void **state) {
    (void)state;
    const double m = 4.0 / 3.0 * RIDDLE_PI * R * R * R * density,
                 stick = contact_jkr_sticking_speed(R, modulus, energy, m);
    assert_true(rebound(JKR, 0.99 * stick, energy, 1.0 / 800.0) == 0.0);
    assert_true(rebound(JKR, 1.01 * stick, energy, 1.0 / 800.0) > 0.0);
    const double ratio[] = {1.05, 1.2, 2.0, 5.0, 20.0};
    for (int k = 0; k < 5; k++) { /* e = sqrt(1 - (V_s/V)^2), Thornton & Ning 1998 */
        const double wanted = sqrt(1.0 - 1.0 / (ratio[k] * ratio[k]));
        near_absolute(rebound(JKR, ratio[k] * stick, energy, 1.0 / 800.0), wanted, 2e-3,
                      "restitution of adhesive impact");
    }
    double worst[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < 3; k++) {
        for (int phase = 0; phase < 10; phase++) {
            const double error = fabs(rebound(JKR, (2.0 + 0.01 * phase) * stick, energy, 0.01 / (1 << (2 * k))) -
                                      sqrt(1.0 - 1.0 / pow(2.0 + 0.01 * phase, 2)));
            worst[k] = error > worst[k] ? error : worst[k];
        }
    }
    /* First order: a jump ends it. */
    assert_true(worst[0] < 4e-3 && worst[1] < 0.4 * worst[0] && worst[2] < 0.4 * worst[1]);
    near_absolute(rebound(DMT, stick, energy, 0.01), 1.0, 1e-4, "DMT without damping gives back what it took");
    near_absolute(rebound(JKR, stick, 0.0, 0.01), 1.0, 1e-4, "JKR without adhesion is Hertz");
}

/* Velocities [3][n] after oblique hits on the plane, in n phases of a step, which is a share of Hertz' contact. */
static void oblique(int which, double speed, double share, double phase_of, int n, double *after) {
    dem_world w;
    dem_def def = grains(0.8, density);
    contact_laws laws = sticky(energy);
    dem_pair(&def, 0, 0)->friction = 0.3;
    start(&w, &def, &laws);
    dem_add_plane(&w, 0, none, up);
    const double tc = dem_hertz_contact_time(modulus, R, 4.0 / 3.0 * RIDDLE_PI * R * R * R * density, speed);
    for (int k = 0; k < n; k++) {
        add(&w, v3(4.0 * R * k, 0, R + speed * tc * phase_of * (k + 0.5) / n), 2.0 * R, 0);
        dem_set_motion(&w, k, v3(speed, 0, -speed), none);
    }
    dem_set_time_step(&w, share * tc);
    run(&w, 4.0 * tc, which);
    for (int k = 0; k < n; k++) {
        const dem_vec v = dem_velocity(&w, k);
        after[3 * k] = v.x / speed, after[3 * k + 1] = v.z / speed, after[3 * k + 2] = R * dem_spin(&w, k).y / speed;
    }
    dem_free(&w);
}

/* The force of a sticky contact passes through zero while friction does not: no hit may make anything of that. */
static void test_friction_of_adhesion(void **state) {
    (void)state;
    enum { HITS = 1000 };
    static double after[3 * HITS], exact[3 * HITS];
    const double m = 4.0 / 3.0 * RIDDLE_PI * R * R * R * density,
                 stick = contact_jkr_sticking_speed(R, modulus, energy, m);
    for (int which = JKR; which <= DMT; which++) {
        for (int ratio = 2; ratio <= 8; ratio *= 2) {
            double worst = 0.0;
            oblique(which, ratio * stick, 1.0 / 20.0, 1.0 / 20.0, HITS, after);
            oblique(which, ratio * stick, 1.0 / 640.0, 1.0 / 20.0, HITS, exact);
            for (int k = 0; k < 3 * HITS; k++) worst = fmax(worst, fabs(after[k] - exact[k]));
            print_message("%s, %d times the speed that sticks: error at t_c/20 at most %.1e\n",
                          uses[which].kernel->law->name, ratio, worst);
            assert_true(worst < (which == JKR ? 0.05 : 0.015));
        }
    }
}

/* A cohesive cloud: contacts that live beyond gap 0 and list rebuilds, with and without skipping, saved and gone on. */
static void cloud(dem_world *w, contact_laws *laws, const dem_def *def) {
    scene_random random = {7};
    start(w, def, laws);
    dem_add_plane(w, 0, v3(0, 0, 0), up);
    for (int k = 0; k < 64; k++) {
        const dem_vec at = v3(2.6e-5 * (k % 4) + 2e-5, 2.6e-5 * (k / 4 % 4) + 2e-5, 2.6e-5 * (k / 16) + 2e-5);
        add(w, at, scene_between(&random, 1.6e-5, 2.4e-5), 0);
        /* in this order, whatever the compiler */
        const dem_vec spin = scene_vector(&random, 1e3), speed = scene_vector(&random, 0.3);
        dem_set_motion(w, k, dem__add(speed, v3(0, 0, -0.2)), spin);
    }
}
static void test_skipping_and_saving(void **state) {
    (void)state;
    for (int which = 0; which < USES; which++) {
        uint64_t hash[6] = {0};
        ptrdiff_t beyond = 0;
        int64_t steps = 0;
        for (int k = 0; k < 6; k++) {
            dem_world w;
            dem_def def = grains(0.6, density);
            contact_laws laws = sticky(energy);
            contact_pair_def *p = contact_pair(&laws, 0, 0);
            p->rolling = p->twisting = 0.1, p->bond_modulus = 1e8, p->tensile = p->shear = 2e6;
            laws.bonding = 1;
            dem_pair(&def, 0, 0)->friction = 0.5;
            dem_pair(&def, 0, 0)->stiffness = 2e3;
            for (int a = 0; a < 2; a++) def.periodic[a] = 1;
            def.high = v3(1.1e-4, 1.1e-4, 1.0);
            def.dt = 2e-9;
            def.skip = k < 4 ? k : DEM_SKIP_ALL;
            def.threads = k == 4 ? 3 : 1;
            cloud(&w, &laws, &def);
            run(&w, 6e-5, which);
            if (k == 5) {
                const size_t size = dem_save(&w, NULL, 0);
                void *bytes = malloc(size);
                dem_save(&w, bytes, size);
                dem_free(&w);
                assert_int_equal(dem_load(&w, bytes, size, NULL), DEM_OK);
                w.user = &laws;
                free(bytes);
            }
            run(&w, 6e-5, which);
            hash[k] = dem_hash(&w);
            for (ptrdiff_t c = 0; c < dem_contact_count(&w); c++) beyond += dem_get_contact(&w, c).gap > 0.0;
            steps += w.contact_steps;
            assert_true(w.rebuilds > 2);
            dem_free(&w);
        }
        for (int k = 1; k < 6; k++) assert_true(hash[k] == hash[0]);
        assert_true(steps > 20000);
        if (which == JKR || which == BONDS) assert_true(beyond > 0);
    }
}

/* ---- several materials ---- */

static void test_three_materials(void **state) {
    (void)state;
    const double e[3][3] = {{0.9, 0.8, 0.7}, {0.8, 0.5, 0.4}, {0.7, 0.4, 0.3}},
                 w_[3][3] = {{0.01, 0.02, 0.03}, {0.02, 0.05, 0.06}, {0.03, 0.06, 0.09}};
    dem_def def = dem_default_def();
    contact_laws laws = contact_default_laws();
    for (int a = 0; a < 3; a++) dem_add_material(&def, density * (1 + a), modulus * (1 + a), 0.1 * (1 + a));
    def.gravity = none;
    for (int a = 0; a < 3; a++) {
        for (int b = a; b < 3; b++) {
            dem_pair(&def, b, a)->restitution = e[a][b];
            dem_pair(&def, a, b)->stiffness = 1e3 * (1 + a + b);
            dem_pair(&def, a, b)->friction = 0.1 * (1 + a + b);
            contact_pair(&laws, b, a)->surface_energy = w_[a][b];
        }
    }
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 4; b++) { /* grain a on grain b, both ways; b = 3: on a wall of material 2 */
            const int other = b < 3 ? b : 2;
            dem_world w;
            start(&w, &def, &laws);
            if (b == 3) dem_add_plane(&w, 2, none, up);
            add(&w, v3(0, 0, R + 1e-8), 2.0 * R, a);
            if (b < 3) add(&w, v3(0, 0, -R), 2.0 * R, b);
            dem_set_motion(&w, 0, v3(0, 0, -0.2), none);
            dem_set_time_step(&w, 0.2 * dem_advise(&w, DEM_LINEAR, 0.2).advised);
            assert_int_equal(dem_run(&w, 5e-6, DEM_LINEAR | DEM_FRICTION), DEM_OK);
            near_absolute((dem_velocity(&w, 0).z - (b < 3 ? dem_velocity(&w, 1).z : 0.0)) / 0.2, e[a][other], 2e-3,
                          "restitution of the pair");
            dem_free(&w);

            start(&w, &def, &laws);
            if (b == 3) dem_add_plane(&w, 2, none, up);
            add(&w, v3(0, 0, R - 1e-9), 2.0 * R, a);
            if (b < 3) add(&w, v3(0, 0, -R), 2.0 * R, b);
            dem_set_time_step(&w, 1e-12);
            run(&w, 0.0, DMT);
            const dem_material *m = &def.material[a], *q = &def.material[other];
            const double radius = b < 3 ? 0.5 * R : R,
                         E = 1.0 / ((1.0 - m->poisson_ratio * m->poisson_ratio) / m->young_modulus +
                                    (1.0 - q->poisson_ratio * q->poisson_ratio) / q->young_modulus);
            near_relative(dem_get_contact(&w, 0).force.z,
                          4.0 / 3.0 * E * sqrt(radius) * pow(1e-9, 1.5) - 2.0 * RIDDLE_PI * w_[a][other] * radius, 1e-6,
                          "force of the pair");
            dem_free(&w);
        }
    }
}

/* ---- rolling and twisting ---- */

static const double ball = 2.5e-3, ball_density = 2500.0, stiffness = 1e5, gravity = 9.81;
static double ball_mass(void) { return 4.0 / 3.0 * RIDDLE_PI * ball * ball * ball * ball_density; }

/* A ball that rests on the plane z = 0 under a gravity tilted by an angle about y. */
static void on_incline(dem_world *w, contact_laws *laws, double angle, double rolling, double twisting, double damping,
                       int which) {
    dem_def def = dem_default_def();
    *laws = contact_default_laws();
    dem_add_material(&def, ball_density, 1e8, 0.2);
    contact_pair(laws, 0, 0)->rolling = rolling;
    contact_pair(laws, 0, 0)->twisting = twisting;
    contact_pair(laws, 0, 0)->rolling_damping = damping;
    dem_pair(&def, 0, 0)->stiffness = stiffness;
    dem_pair(&def, 0, 0)->friction = 0.8;
    dem_pair(&def, 0, 0)->restitution = 0.5;
    dem_pair(&def, 0, 0)->tangential_damping = 1.0;
    def.gravity = v3(gravity * sin(angle), 0, -gravity * cos(angle));
    def.dt = 2e-6;
    start(w, &def, laws);
    dem_add_plane(w, 0, none, up);
    const double weight = ball_mass() * gravity * cos(angle), E = 1e8 / (2.0 * (1.0 - 0.04));
    const double overlap = which == EPSD ? weight / stiffness : pow(weight / (4.0 / 3.0 * E * sqrt(ball)), 2.0 / 3.0);
    add(w, v3(0, 0, ball - overlap), 2.0 * ball, 0);
}
/* Greatest torque over elastic range: k_r = 2.25 k_n (mu R)^2. */
static double elastic_angle(double mu, int which) {
    const double weight = ball_mass() * gravity, E = 1e8 / (2.0 * (1.0 - 0.04));
    const double k = which == EPSD ? stiffness : weight / pow(weight / (4.0 / 3.0 * E * sqrt(ball)), 2.0 / 3.0);
    return weight / (2.25 * k * mu * ball);
}

static void test_rolling_stops(void **state) {
    (void)state;
    for (int which = EPSD; which <= EPSD_HERTZ; which++) {
        for (int damped = 0; damped < 2; damped++) {
            const double mu = 0.02, v = 0.05;
            dem_world w;
            contact_laws laws;
            on_incline(&w, &laws, 0.0, mu, 0.0, damped ? 0.3 : 0.0, which);
            dem_set_motion(&w, 0, v3(v, 0, 0), v3(0, v / ball, 0));
            run(&w, 0.0, which);
            /* the spring at its end, as if it had rolled before: else the dashpot takes its share of the start */
            if (damped) {
                dem_contact_info c = dem_get_contact(&w, 0);
                c.state[CONTACT_ANGLE + 1] = elastic_angle(mu, which);
                dem_set_contact_state(&w, 0, c.state);
            }
            double farthest = 0.0, still = 0.0;
            for (int k = 0; k < 1500; k++) {
                run(&w, 1e-3, which);
                if (dem_position(&w, 0).x > farthest) farthest = dem_position(&w, 0).x;
                if (k == 999) still = dem_position(&w, 0).x;
            }
            /* 7/10 m v^2 = mu m g (x - R theta/2), theta: the elastic range */
            const double back = ball * elastic_angle(mu, which),
                         wanted = 0.7 * v * v / (mu * gravity) + (damped ? 0.0 : 0.5 * back);
            near_relative(farthest, wanted, 1e-3, "stopping distance");
            if (damped) near_absolute(dem_position(&w, 0).x, still, 1e-9, "at rest");
            else assert_true(farthest - dem_position(&w, 0).x > 0.0); /* swings about a place behind */
            dem_free(&w);
        }
    }
}

static void test_incline_holds(void **state) {
    (void)state;
    const double mu = 0.1;
    for (int which = EPSD; which <= EPSD_HERTZ; which++) {
        for (int k = 0; k < 2; k++) {
            dem_world w;
            contact_laws laws;
            const double angle = atan((k ? 1.2 : 0.95) * mu);
            on_incline(&w, &laws, angle, mu, 0.0, 0.3, which);
            run(&w, 0.5, which);
            const double x = dem_position(&w, 0).x, v = dem_velocity(&w, 0).x;
            run(&w, k ? 0.5 : 2.0, which);
            if (k == 0) {
                near_absolute(dem_position(&w, 0).x, x, 1e-11, "creep in two seconds");
                near_absolute(dem_velocity(&w, 0).x, 0.0, 1e-10, "velocity at rest");
            } else {
                const double arm = 1.0 + dem_get_contact(&w, 0).gap / ball; /* over the radius */
                near_relative(2.0 * (dem_velocity(&w, 0).x - v),
                              gravity * (sin(angle) * arm * arm - mu * cos(angle) * arm) / (0.4 + arm * arm), 1e-4,
                              "rolls down");
            }
            dem_free(&w);
        }
    }
}

static void test_twisting_decays(void **state) {
    (void)state;
    for (int which = EPSD; which <= EPSD_HERTZ; which++) {
        const double mu = 0.02, spin = 40.0, inertia = 0.4 * ball_mass() * ball * ball;
        dem_world w;
        contact_laws laws;
        on_incline(&w, &laws, 0.0, 0.0, mu, 0.0, which);
        dem_set_motion(&w, 0, none, v3(0, 0, spin));
        /* a spring up to the greatest torque M, then M: spin (t) = sqrt(spin^2 - M theta/I) - M (t - t1)/I */
        const double most = mu * ball * ball_mass() * gravity, theta = elastic_angle(mu, which), k = most / theta;
        const double sliding = sqrt(spin * spin - most * theta / inertia),
                     t1 = asin(most / (spin * sqrt(k * inertia))) / sqrt(k / inertia);
        const double t = 0.5 * spin * inertia / most;
        run(&w, t, which);
        near_relative(dem_spin(&w, 0).z + w.spin_rate[0].z * (double)(w.step - w.particle[0].origin) * w.def.dt,
                      sliding - most / inertia * (t - t1), 1e-4, "spin");
        near_absolute(dem_position(&w, 0).x, 0.0, 1e-15, "it stays where it is");
        dem_free(&w);
        on_incline(&w, &laws, 0.0, 0.0, mu, 0.3, which);
        dem_set_motion(&w, 0, none, v3(0, 0, spin));
        run(&w, 2.0 * spin * inertia / most, which);
        near_absolute(dem_spin(&w, 0).z, 0.0, 1e-6, "stopped");
        dem_free(&w);
    }
}

static void test_ledger_of_rolling(void **state) {
    (void)state;
    for (int which = EPSD; which <= EPSD_HERTZ; which++) {
        double error[2];
        for (int k = 0; k < 2; k++) {
            dem_world w;
            contact_laws laws;
            on_incline(&w, &laws, 0.0, 0.02, 0.02, 0.3, which);
            dem_set_time_step(&w, k ? 5e-7 : 2e-6);
            dem_set_motion(&w, 0, v3(0.05, 0, -0.05), v3(3.0, 0.05 / ball, 40.0));
            run_with_ledger(&w, 0.5, which);
            const dem_energy_ledger l = dem_energy(&w);
            error[k] = fabs(l.error) / (l.kinetic + l.rotational + l.normal_loss + l.sliding_loss + l.rolling_loss);
            assert_true(l.rolling_loss >= 0.0 && l.sliding_loss > 0.0 &&
                        l.kinetic + l.rotational < 1e-2 * l.sliding_loss);
            dem_free(&w);
        }
        assert_true(error[0] < 6e-3);
        assert_true(error[1] < error[0]);
    }
}

/* ---- bonds ---- */

enum { LONGEST = 12 };
static const double bond_modulus = 1e7;

/* A row of n balls along x from the wall x = 0, each 1 nm into the next, bonded where they touch. */
static void bonded_row(dem_world *w, contact_laws *laws, int n, double tensile, double shear, double damping) {
    dem_def def = dem_default_def();
    *laws = contact_default_laws();
    contact_pair_def *p = contact_pair(laws, 0, 0);
    dem_add_material(&def, ball_density, 1e8, 0.2);
    def.gravity = none;
    dem_pair(&def, 0, 0)->stiffness = stiffness;
    p->bond_modulus = bond_modulus, p->bond_damping = damping, p->tensile = tensile, p->shear = shear;
    const double k = bond_modulus * RIDDLE_PI * ball;
    def.dt = 0.05 * sqrt(ball_mass() / k);
    start(w, &def, laws);
    dem_add_plane(w, 0, none, v3(1, 0, 0));
    for (int i = 0; i < n; i++) add(w, v3((2 * i + 1) * (ball - 0.5e-9) - 0.5e-9, 0, 0), 2.0 * ball, 0);
    laws->bonding = 1;
    run(w, 0.0, BONDS);
    laws->bonding = 0;
    assert_int_equal(dem_contact_count(w), n);
    for (ptrdiff_t c = 0; c < n; c++) assert_true(contact_is_bond(w, c));
}
/* To rest, by a drag of a tenth of critical on each. */
static void settle(dem_world *w, double drag, double t) {
    for (double end = w->time + t; w->time < end;) {
        run(w, 10.0 * w->def.dt, BONDS);
        for (ptrdiff_t i = 0; i < w->count; i++) {
            dem_vec v = dem_velocity(w, i);
            const double c = 1.0 - drag * 10.0 * w->def.dt, s = c > 0.0 ? c : 0.0;
            dem_set_motion(w, i, dem__scale(s, v),
                           v3(s * dem_spin(w, i).x, s * dem_spin(w, i).y, s * dem_spin(w, i).z));
        }
    }
}

static void test_beam(void **state) {
    (void)state;
    const double area = RIDDLE_PI * ball * ball, second = 0.25 * area * ball * ball, length = 2.0 * ball;
    const double bend = bond_modulus * second / length, shear = 0.4 * bond_modulus * area / length,
                 stretch = bond_modulus * area / length;
    for (int n = 2; n <= 6; n += 2) {
        dem_world w;
        contact_laws laws;
        /* Sum over the joints of lever^2/bend and 1/shear; the one at the wall is half as long, twice as stiff. */
        double wanted = 0.0;
        for (int k = 0; k < n; k++) {
            const double lever = (n - 0.5 - k) * length, twice = k ? 1.0 : 2.0;
            wanted += lever * lever / (twice * bend) + 1.0 / (twice * shear);
        }
        /* About the lowest frequency. */
        const double load = 1e-4 * length / wanted, slow = sqrt(1.0 / (wanted * n * ball_mass()));
        bonded_row(&w, &laws, n, HUGE_VAL, HUGE_VAL, 0.1);
        dem_set_load(&w, n - 1, v3(0, load, 0), none);
        settle(&w, slow, 25.0 / slow);
        near_relative(dem_position(&w, n - 1).y, load * wanted, 1e-4, "deflection of a cantilever");
        const double straight = (n - 0.5) * length;
        if (n == 6)
            near_relative(load * wanted, load * (straight * straight * straight / (3.0 * bond_modulus * second)), 0.1,
                          "Euler's beam");
        dem_set_load(&w, n - 1, v3(load, 0, 0), v3(1e-6, 0, 0));
        settle(&w, slow, 40.0 / slow);
        near_relative(dem_position(&w, n - 1).x - ((2 * n - 1) * (ball - 0.5e-9) - 0.5e-9), load * (n - 0.5) / stretch,
                      1e-3, "stretched");
        const dem_contact_info c = dem_get_contact(&w, dem_contact_count(&w) - 1);
        near_relative(fabs(c.state[CONTACT_TURNED]),
                      1e-6 * length / (0.8 * bond_modulus * second) * (c.j < 0 ? 0.5 : 1.0), 1e-3, "twisted");
        dem_free(&w);
    }
}

/* Loads of 0.998 and 1.002 of the strength, applied slowly: pulled, sheared with its bending, twisted. */
static void test_bond_breaks(void **state) {
    (void)state;
    const double area = RIDDLE_PI * ball * ball, strength = 1e3;
    for (int way = 0; way < 4; way++) {
        for (int k = 0; k < 2; k++) {
            dem_world w;
            contact_laws laws;
            /* bent by F at the first ball's centre: sigma = F R/(A R/4) = 4 F/A at the wall */
            const double most = way == 0   ? strength * area
                                : way == 1 ? 0.25 * strength * area
                                : way == 2 ? strength * area
                                           : 0.5 * strength * area * ball;
            bonded_row(&w, &laws, 1, way < 2 ? strength : HUGE_VAL, way < 2 ? HUGE_VAL : strength, 0.5);
            for (int s = 1; s <= 1000; s++) {
                const double f = (k ? 1.002 : 0.998) * most * s / 1000.0;
                dem_set_load(&w, 0,
                             way == 0  ? v3(f, 0, 0)
                             : way < 3 ? v3(0, f, 0)
                                       : none,
                             way == 3 ? v3(f, 0, 0) : none);
                settle(&w, 0.0, 20.0 * w.def.dt);
            }
            settle(&w, 0.0, 2000.0 * w.def.dt);
            const int whole = dem_contact_count(&w) > 0 && contact_is_bond(&w, 0);
            if (whole != !k)
                fail_msg("way %d: %s at %g of the strength", way, whole ? "whole" : "broken", k ? 1.002 : 0.998);
            dem_free(&w);
        }
    }
}

/* A bonded ball that is hit breaks off; every joule is found again. A broken bond that overlaps is an
   ordinary contact. */
static void test_ledger_of_bonds(void **state) {
    (void)state;
    dem_world w;
    contact_laws laws;
    bonded_row(&w, &laws, 4, 2e4, 2e4, 0.1);
    dem_set_time_step(&w, 0.2 * w.def.dt);
    dem_set_motion(&w, 3, v3(-0.05, 0.1, 0.05), v3(20.0, 0, 0));
    run_with_ledger(&w, 0.02, BONDS);
    const dem_energy_ledger l = dem_energy(&w);
    int whole = 0;
    for (ptrdiff_t c = 0; c < dem_contact_count(&w); c++) whole += contact_is_bond(&w, c);
    assert_true(whole < 4);
    near_absolute(l.error, 0.0, 2e-3 * l.start, "ledger");
    dem_free(&w);
    laws = contact_default_laws(); /* nothing bonds that was not told to */
    dem_def def = dem_default_def();
    dem_add_material(&def, ball_density, 1e8, 0.2);
    start(&w, &def, &laws);
    laws.bonding = 1;
    add(&w, none, 2.0 * ball, 0), add(&w, v3(2.0 * ball - 1e-6, 0, 0), 2.0 * ball, 0);
    run(&w, 0.0, BONDS);
    assert_int_equal(dem_contact_count(&w), 1);
    assert_false(contact_is_bond(&w, 0));
    near_relative(dem_get_contact(&w, 0).force.x, -1e5 * 1e-6, 1e-6, "an ordinary contact");
    dem_free(&w);
}

/* What touches already becomes a bond, once, where its pair has one; then it holds what parts the others. */
static void test_bonds_of_what_touches(void **state) {
    (void)state;
    contact_laws laws = contact_default_laws();
    dem_world w;
    dem_def def = dem_default_def();
    const double ball_at[] = {0.0, 2.0 * ball - 1e-6, 5.0 * ball, 7.0 * ball - 1e-6, 10.0 * ball};
    for (int m = 0; m < 2; m++) dem_add_material(&def, ball_density, 1e8, 0.2);
    def.gravity = none, def.dt = 1e-6;
    contact_pair_def *p = contact_pair(&laws, 0, 0);
    p->bond_modulus = 1e6, p->tensile = p->shear = 1e6;
    start(&w, &def, &laws);
    /* the second pair does not bond */
    for (int k = 0; k < 5; k++) add(&w, v3(ball_at[k], 0, 0), 2.0 * ball, k == 2 || k == 3);
    assert_int_equal(contact_bond_touching(&w), 0); /* nothing has run: no contacts are known */
    run(&w, 1e-6, BONDS);
    assert_int_equal(contact_bond_touching(&w), 1);
    assert_int_equal(contact_bond_touching(&w), 0);
    for (ptrdiff_t c = 0; c < dem_contact_count(&w); c++)
        assert_int_equal(contact_is_bond(&w, c), dem_get_contact(&w, c).i < 2);
    for (int i = 0; i < 4; i++) dem_set_motion(&w, i, v3(i % 2 ? 0.01 : -0.01, 0, 0), none);
    run(&w, 0.02, BONDS);
    assert_true(dem_position(&w, 1).x - dem_position(&w, 0).x < 2.01 * ball &&
                dem_position(&w, 3).x - dem_position(&w, 2).x > 2.01 * ball);
    w.user = NULL;
    assert_int_equal(contact_bond_touching(&w) + contact_bond_touching(NULL), 0);
    dem_free(&w);
}

/* ---- hostile input ---- */

static void test_bad_parameters(void **state) {
    (void)state;
    static const struct {
        size_t offset;
        const char *name;
    } fields[] = {{offsetof(contact_pair_def, rolling), "rolling"},
                  {offsetof(contact_pair_def, rolling_damping), "rolling_damping"},
                  {offsetof(contact_pair_def, twisting), "twisting"},
                  {offsetof(contact_pair_def, surface_energy), "surface_energy"},
                  {offsetof(contact_pair_def, bond_modulus), "bond_modulus"},
                  {offsetof(contact_pair_def, bond_shear), "bond_shear"},
                  {offsetof(contact_pair_def, bond_radius), "bond_radius"},
                  {offsetof(contact_pair_def, bond_damping), "bond_damping"},
                  {offsetof(contact_pair_def, tensile), "tensile"},
                  {offsetof(contact_pair_def, shear), "shear"}};
    const double bad[] = {-1.0, (double)NAN, -HUGE_VAL};
    contact_laws laws = contact_default_laws();
    assert_null(contact_bad_field(&laws));
    assert_non_null(contact_bad_field(NULL));
    assert_null(contact_pair(&laws, -1, 0));
    assert_null(contact_pair(&laws, 0, DEM_MATERIALS_MAX));
    assert_null(contact_pair(NULL, 0, 0));
    assert_ptr_equal(contact_pair(&laws, 2, 5), contact_pair(&laws, 5, 2));
    for (size_t f = 0; f < sizeof fields / sizeof *fields; f++) {
        for (int k = 0; k < 3; k++) {
            laws = contact_default_laws();
            memcpy((char *)contact_pair(&laws, 3, 1) + fields[f].offset, &bad[k], sizeof bad[k]);
            assert_string_equal(contact_bad_field(&laws), fields[f].name);
        }
    }
}

/* Parameters that nobody checked: a status or a run, never a crash. */
static void test_unchecked_parameters(void **state) {
    (void)state;
    const double values[] = {0.0, 1e-300, 1e300, -1.0, (double)NAN, (double)INFINITY};
    int refused = 0;
    for (int which = 0; which < USES; which++) {
        for (size_t f = 0; f < sizeof(contact_pair_def) / sizeof(double); f++) {
            for (int k = 0; k < 6; k++) {
                dem_world w;
                dem_def def = grains(0.6, density);
                contact_laws laws = sticky(energy);
                laws.bonding = 1;
                contact_pair(&laws, 0, 0)->rolling = contact_pair(&laws, 0, 0)->twisting = 0.1;
                contact_pair(&laws, 0, 0)->bond_modulus = 1e7;
                memcpy((double *)contact_pair(&laws, 0, 0) + f, &values[k], sizeof(double));
                def.dt = 1e-9;
                def.gravity = v3(1.0, 0, -1.0);
                assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
                w.user = &laws;
                dem_add_plane(&w, 0, none, up);
                add(&w, v3(0, 0, R - 1e-9), 2.0 * R, 0);
                const dem_status status = dem_run_law(&w, 2e-8, uses[which].kernel);
                assert_true(status == DEM_OK || status == DEM_NOT_FINITE || status == DEM_TOO_FAST);
                refused += status != DEM_OK;
                dem_free(&w);
            }
        }
    }
    assert_true(refused > 0);
}

/* world.user was forgotten: the run says that its numbers are none. */
static void test_forgotten_laws(void **state) {
    (void)state;
    for (int which = 0; which < USES; which++) {
        dem_world w;
        dem_def def = grains(0.6, density);
        def.dt = 1e-9;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        dem_add_plane(&w, 0, none, up);
        add(&w, v3(0, 0, R - 1e-9), 2.0 * R, 0);
        dem_set_motion(&w, 0, none, v3(1.0, 2.0, 3.0));
        assert_int_equal(dem_run_law(&w, 2e-8, uses[which].kernel), DEM_NOT_FINITE);
        dem_free(&w);
    }
}

static dem_status everything(failing_allocator *memory, int which) {
    dem_world w;
    dem_def def = grains(0.6, density);
    contact_laws laws = sticky(energy);
    contact_pair(&laws, 0, 0)->bond_modulus = 1e8;
    laws.bonding = 1;
    def.allocator.fn = failing_fn, def.allocator.user = memory;
    def.dt = 2e-9;
    dem_status status = dem_init(&w, &def, NULL);
    if (status != DEM_OK) return status;
    w.user = &laws;
    scene_random random = {3};
    for (int k = 0; k < 80 && status == DEM_OK; k++) {
        const dem_vec at = v3(1.999e-5 * (k % 5), 1.999e-5 * (k / 5), scene_between(&random, 0, 1e-9));
        const double d = 2.0 * R;
        status = dem_add_spheres(&w, 1, &at.x, &d, 0, 0);
    }
    if (status == DEM_OK) status = dem_run_law(&w, 1e-7, uses[which].kernel);
    dem_free(&w);
    return status;
}
static void test_memory_running_out(void **state) {
    (void)state;
    for (int which = 0; which < USES; which++) {
        for (int k = 0;; k++) {
            failing_allocator memory;
            failing_init_at(&memory, k);
            const dem_status status = everything(&memory, which);
            assert_int_equal(failing_live(&memory), 0);
            assert_int_equal(status, memory.has_failed ? DEM_OUT_OF_MEMORY : DEM_OK);
            if (!memory.has_failed) break;
        }
    }
}

/* ---- dem_wet.h ---- */

/* Two spheres of 5 mm with films, one above the other in contact, the upper one held; gravity pulls at
   the lower one. */
static dem_status hang(double pull, bool printed, double *volume, int *bridges, double *force, double *gap,
                       dem_allocator *memory) {
    dem_def def = dem_default_def();
    double centre[] = {0, 0, 0, 0, 0, -0.0049999}, diameter[] = {0.005, 0.005},
           size[WET_CLASSES] = {0.005, 0.005, 0.005};
    int group[] = {0, 0};
    const int glass = dem_add_material(&def, 2500.0, 5e6, 0.3);
    dem_world w;
    wet_scene water;
    if (memory) def.allocator = *memory;
    def.gravity = v3(0.0, 0.0, -pull);
    memset(&water, 0, sizeof water);
    dem_status status = dem_init(&w, &def, NULL);
    if (status != DEM_OK) return status;
    const int far_floor = dem_add_plane(&w, glass, v3(0, 0, -1.0), up);
    if (far_floor < 0) status = DEM_OUT_OF_MEMORY;
    if (status == DEM_OK) status = dem_add_spheres(&w, 2, centre, diameter, glass, 0);
    if (status == DEM_OK) status = dem_fix(&w, 0, 1);
    if (status == DEM_OK &&
        wet_init(&water, 2, group, diameter, size, 0.002, 3.27e-4, far_floor, &w, printed, WET_STEEL) != BRIDGE_OK)
        status = DEM_OUT_OF_MEMORY;
    w.user = &water;
    if (status == DEM_OK) status = wet_run(&w, 0.02, 0);
    if (status == DEM_OK) {
        *volume = wet_total(&water, &w, bridges) / water.initial;
        *gap = dem_position(&w, 0).z - dem_position(&w, 1).z - 0.005;
        bridge b;
        if (*bridges > 0) {
            memcpy(&b, dem_get_link(&w, 0).state, sizeof b);
            *force = bridge_attraction(&b, 0.0);
        }
    }
    wet_free(&water);
    dem_free(&w);
    return status;
}

static void test_wet_grain_hangs(void **state) {
    (void)state;
    double volume, force = 0.0, gap, unused;
    int bridges;
    for (int printed = 0; printed < 2; printed++) {
        assert_int_equal(hang(0.0, printed, &volume, &bridges, &force, &gap, NULL), DEM_OK);
        assert_int_equal(bridges, 1);
        assert_true(volume == 1.0); /* to the last bit */
        assert_true(gap < 0.0);     /* drawn together */
        const double balance = force / (2500.0 * RIDDLE_PI / 6.0 * 0.005 * 0.005 * 0.005);
        assert_true(force > 1e-4);
        if (printed) continue; /* its force is another one */
        assert_int_equal(hang(0.98 * balance, printed, &volume, &bridges, &unused, &gap, NULL), DEM_OK);
        assert_int_equal(bridges, 1);
        assert_int_equal(hang(3.0 * balance, printed, &volume, &bridges, &unused, &gap, NULL), DEM_OK);
        assert_int_equal(bridges, 0); /* torn off; its liquid is in the films again */
        assert_true(volume == 1.0);
        assert_true(gap > 0.0);
    }
}

static void test_wet_bad_arguments(void **state) {
    (void)state;
    dem_def def = dem_default_def();
    const int glass = dem_add_material(&def, 2500.0, 5e6, 0.3);
    double d[] = {0.005}, size[WET_CLASSES] = {0.005, 0.005, 0.005}, bad[WET_CLASSES] = {0.005, NAN, 0.005},
           huge[] = {INFINITY};
    int group[] = {0}, wrong[] = {WET_CLASSES};
    dem_world w;
    wet_scene s;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    const int deck = dem_add_plane(&w, glass, none, up);
    assert_int_equal(wet_init(NULL, 1, group, d, size, 0.1, 1.0, deck, &w, false, 1.0), BRIDGE_INVALID);
    assert_int_equal(wet_init(&s, 1, NULL, d, size, 0.1, 1.0, deck, &w, false, 1.0), BRIDGE_INVALID);
    assert_int_equal(wet_init(&s, 1, group, NULL, size, 0.1, 1.0, deck, &w, false, 1.0), BRIDGE_INVALID);
    assert_int_equal(wet_init(&s, 1, group, d, NULL, 0.1, 1.0, deck, &w, false, 1.0), BRIDGE_INVALID);
    assert_int_equal(wet_init(&s, 1, group, d, size, 0.1, 1.0, deck, NULL, false, 1.0), BRIDGE_INVALID);
    assert_int_equal(wet_init(&s, -1, group, d, size, 0.1, 1.0, deck, &w, false, 1.0), BRIDGE_INVALID);
    assert_int_equal(wet_init(&s, 1, wrong, d, size, 0.1, 1.0, deck, &w, false, 1.0), BRIDGE_INVALID);
    assert_int_equal(wet_init(&s, 1, group, huge, size, 0.1, 1.0, deck, &w, false, 1.0), BRIDGE_INVALID);
    assert_int_not_equal(wet_init(&s, 1, group, d, bad, 0.1, 1.0, deck, &w, false, 1.0), BRIDGE_OK);
    assert_int_equal(wet_init(&s, 1, group, d, size, NAN, 1.0, deck, &w, false, 1.0), BRIDGE_INVALID);
    assert_int_equal(wet_init(&s, 1, group, d, size, 0.1, -1.0, deck, &w, false, 1.0), BRIDGE_INVALID);
    assert_int_equal(wet_init(&s, 1, group, d, size, 0.1, 1.0, 7, &w, false, 1.0), BRIDGE_INVALID);
    assert_int_equal(wet_init(&s, 1, group, d, size, 0.1, 1.0, INT_MAX, &w, false, 1.0), BRIDGE_INVALID);
    assert_int_not_equal(wet_init(&s, 1, group, d, size, 0.1, 1.0, deck, &w, false, NAN), BRIDGE_OK);
    assert_int_equal(wet_prepare(&s, 1, group, size, 1.0, 0, INT_MAX, &w, false, 1.0), BRIDGE_INVALID);
    assert_int_equal(wet_run(NULL, 1.0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(wet_run(&w, 1.0, 0), DEM_BAD_ARGUMENT); /* no scene */
    assert_int_equal(wet_init(&s, 0, group, d, size, 0.0, 0.0, deck, &w, false, 1.0), BRIDGE_OK);
    assert_true(wet_total(&s, &w, NULL) == 0.0);
    wet_free(&s);
    wet_free(&s);
    wet_free(NULL);
    dem_free(&w);
}

static void test_wet_memory_running_out(void **state) {
    (void)state;
    for (int k = 0;; k++) {
        failing_allocator memory;
        double volume, force, gap;
        int bridges;
        failing_init_at(&memory, k);
        dem_allocator hook = {failing_fn, &memory};
        const dem_status status = hang(1.0, false, &volume, &bridges, &force, &gap, &hook);
        assert_int_equal(failing_live(&memory), 0);
        assert_true(memory.has_failed ? status != DEM_OK : status == DEM_OK);
        if (!memory.has_failed) break;
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_jkr_formulas),
        cmocka_unit_test(test_formulas_outside_their_domain),
        cmocka_unit_test(test_pull_off_force),
        cmocka_unit_test(test_grain_hangs),
        cmocka_unit_test(test_adhesive_restitution),
        cmocka_unit_test(test_friction_of_adhesion),
        cmocka_unit_test(test_skipping_and_saving),
        cmocka_unit_test(test_three_materials),
        cmocka_unit_test(test_rolling_stops),
        cmocka_unit_test(test_incline_holds),
        cmocka_unit_test(test_twisting_decays),
        cmocka_unit_test(test_ledger_of_rolling),
        cmocka_unit_test(test_beam),
        cmocka_unit_test(test_bond_breaks),
        cmocka_unit_test(test_ledger_of_bonds),
        cmocka_unit_test(test_bonds_of_what_touches),
        cmocka_unit_test(test_bad_parameters),
        cmocka_unit_test(test_unchecked_parameters),
        cmocka_unit_test(test_forgotten_laws),
        cmocka_unit_test(test_memory_running_out),
        cmocka_unit_test(test_wet_grain_hangs),
        cmocka_unit_test(test_wet_bad_arguments),
        cmocka_unit_test(test_wet_memory_running_out),
    };
    return cmocka_run_group_tests_name("dem_laws", tests, NULL, NULL);
}
