/* dem.h against answers from elsewhere: the impact tests of Chung & Ooi (2011), restitution over all phases of the
   first step, a bouncing sphere solved from event to event, settled beds against a plain integrator with another list
   and a smaller step. */
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

/* ---- one impact: sphere 0 comes down along z on a sphere or on a plane ---- */

typedef struct impact {
    double radius, velocity_n, velocity_t, spin; /* of sphere 0: v = (velocity_t, 0, -velocity_n), w about y */
    double other_radius, other_density;          /* 0: a plane */
    double other_velocity_n, other_spin;         /* of the other sphere, up */
    double young, poisson, density, wall_young, wall_poisson;
    double restitution, friction, tangential_damping;
    int features;
    double steps;             /* per contact time */
    double phase;             /* part of a step before the first contact */
    const dem_kernel *kernel; /* NULL: the shipped one */
} impact;

typedef struct outcome {
    double vn, vt, spin, contact_vt; /* after: v . z, v . x, w . y, velocity of the point that touched */
    double other_vt, other_spin;
    double force, overlap, duration;
} outcome;

static impact plane_impact(double radius, double vn, double young, double poisson, double density, double e,
                           double mu) {
    impact a = {0};
    a.radius = radius, a.velocity_n = vn, a.young = a.wall_young = young, a.poisson = a.wall_poisson = poisson,
    a.density = density;
    a.restitution = e, a.friction = mu, a.steps = 100.0, a.phase = 0.4;
    a.features = DEM_HERTZ | (mu > 0.0 ? DEM_FRICTION : 0);
    return a;
}

static outcome run_impact(const impact *a) {
    dem_world world;
    dem_def def = dem_default_def();
    outcome o = {0};
    int m = dem_add_material(&def, a->density, a->young, a->poisson), n;
    double closing = a->velocity_n + a->other_velocity_n;
    n = dem_add_material(&def, a->other_radius > 0.0 ? a->other_density : 1.0, a->wall_young, a->wall_poisson);
    dem_pair_def *pair = dem_pair(&def, m, n);
    pair->restitution = a->restitution, pair->friction = a->friction, pair->tangential_damping = a->tangential_damping;
    def.gravity = dem_vec3(0, 0, 0);
    double estimate =
        1.0 / ((1.0 - a->poisson * a->poisson) / a->young + (1.0 - a->wall_poisson * a->wall_poisson) / a->wall_young);
    double mass = 4.0 / 3.0 * RIDDLE_PI * pow(a->radius, 3) * a->density,
           other = 4.0 / 3.0 * RIDDLE_PI * pow(a->other_radius, 3) * a->other_density;
    double r = a->radius, meff = mass;
    if (a->other_radius > 0.0) r = r * a->other_radius / (r + a->other_radius), meff = mass * other / (mass + other);
    double t_c = dem_hertz_contact_time(estimate, r, meff, closing);
    def.dt = t_c / a->steps;
    assert_int_equal(dem_init(&world, &def, NULL), DEM_OK);
    double height = a->radius + closing * def.dt * (3.0 + a->phase), at[3] = {0.0, 0.0, height},
           below[3] = {0.0, 0.0, -a->other_radius}, d = 2.0 * a->radius, d2 = 2.0 * a->other_radius;
    assert_int_equal(dem_add_spheres(&world, 1, at, &d, m, 0), DEM_OK);
    if (a->other_radius > 0.0) {
        assert_int_equal(dem_add_spheres(&world, 1, below, &d2, n, 0), DEM_OK);
        assert_int_equal(dem_set_motion(&world, 1, dem_vec3(0, 0, a->other_velocity_n), dem_vec3(0, a->other_spin, 0)),
                         DEM_OK);
    } else assert_true(dem_add_plane(&world, n, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) >= 0);
    assert_int_equal(dem_set_motion(&world, 0, dem_vec3(a->velocity_t, 0, -a->velocity_n), dem_vec3(0, a->spin, 0)),
                     DEM_OK);
    int touched = 0, left = 0;
    for (int k = 0; k < (int)(20.0 * a->steps) && !left; k++) {
        assert_int_equal(a->kernel ? dem_run_law(&world, def.dt, a->kernel) : dem_run(&world, def.dt, a->features),
                         DEM_OK);
        if (dem_contact_count(&world) > 0) {
            dem_contact_info c = dem_get_contact(&world, 0);
            touched++;
            o.force = c.force.z > o.force ? c.force.z : o.force;
            o.overlap = -c.gap > o.overlap ? -c.gap : o.overlap;
        } else left = touched > 0;
    }
    assert_true(left);
    dem_vec v = dem_velocity(&world, 0);
    o.duration = touched * def.dt;
    o.vn = v.z, o.vt = v.x, o.spin = dem_spin(&world, 0).y;
    o.contact_vt = v.x - a->radius * o.spin;
    if (a->other_radius > 0.0) o.other_vt = dem_velocity(&world, 1).x, o.other_spin = dem_spin(&world, 1).y;
    dem_free(&world);
    return o;
}

/* ---- Chung & Ooi (2011) ---- */

static void test_chung_ooi_1_pair(void **state) {
    (void)state;
    static const struct {
        double young, poisson, density, force, overlap, duration;
    } m[2] = {{48e9, 0.20, 2800.0, 10697.0, 274.1e-6, 40.34e-6}, {20e9, 0.25, 2500.0, 7108.0, 368.3e-6, 54.20e-6}};
    for (int k = 0; k < 2; k++) {
        impact a = plane_impact(0.01, 10.0, m[k].young, m[k].poisson, m[k].density, 1.0, 0.0);
        a.other_radius = 0.01, a.other_density = m[k].density, a.other_velocity_n = 10.0, a.steps = 1000.0;
        outcome o = run_impact(&a);
        near_relative(o.force, m[k].force, 2e-4, "largest force");
        near_relative(o.overlap, m[k].overlap, 2e-4, "largest overlap");
        near_relative(o.duration, m[k].duration, 2e-3, "duration");
        near_relative(o.vn, 10.0, 1e-6, "velocity after");
    }
}

static void test_chung_ooi_2_plane(void **state) {
    (void)state;
    static const struct {
        double young, poisson, density, force, overlap, duration;
    } m[2] = {{70e9, 0.30, 2699.0, 11370.0, 49.72e-6, 731.6e-6}, {40e9, 0.35, 1800.0, 7233.0, 52.12e-6, 767.1e-6}};
    for (int k = 0; k < 2; k++) {
        impact a = plane_impact(0.1, 0.2, m[k].young, m[k].poisson, m[k].density, 1.0, 0.0);
        a.wall_young = 1e6 * a.young; /* rigid */
        a.steps = 1000.0;
        outcome o = run_impact(&a);
        near_relative(o.force, m[k].force, 2e-4, "largest force");
        near_relative(o.overlap, m[k].overlap, 2e-4, "largest overlap");
        near_relative(o.duration, m[k].duration, 2e-3, "duration");
        near_relative(o.vn, 0.2, 1e-6, "velocity after");
    }
}

static void test_chung_ooi_3_restitution(void **state) {
    (void)state;
    double worst = 0.0;
    for (int k = 0; k <= 20; k++) {
        for (int material = 0; material < 2; material++) {
            double e = k == 0 ? 0.02 : 0.05 * k;
            impact a = material ? plane_impact(2.5e-3, 3.9, 100e9, 0.25, 7000.0, e, 0.0)
                                : plane_impact(2.5e-3, 3.9, 380e9, 0.23, 4000.0, e, 0.0);
            outcome o = run_impact(&a);
            worst = fmax(worst, fabs(o.vn / 3.9 - e));
        }
    }
    print_message("Hertz restitution at t_c/100, e = 0.02 .. 1: largest deviation %.1e\n", worst);
    assert_true(worst < 2e-4);
}

/* Columns: angle from the normal [deg], tangential restitution, spin [rad/s], rebound angle of the contact
   point [deg]. */
static void test_chung_ooi_4_oblique(void **state) {
    (void)state;
    static const double table[13][4] = {{5, 0.948, -19, 3.8},    {10, 0.687, -213, -1.6}, {15, 0.624, -378, -5.5},
                                        {20, 0.616, -511, -7.5}, {25, 0.634, -599, -7.5}, {30, 0.684, -617, -3.5},
                                        {35, 0.737, -582, 3.4},  {40, 0.781, -545, 11.6}, {50, 0.845, -457, 29.4},
                                        {60, 0.893, -357, 47.8}, {70, 0.932, -246, 64.6}, {80, 0.966, -126, 78.7},
                                        {85, 0.983, -63, 84.5}};
    for (int k = 0; k < 13; k++) {
        double theta = table[k][0] * RIDDLE_PI / 180.0, v = 3.9, r = 2.5e-3, mu = 0.092, e = 0.98;
        impact a = plane_impact(r, v * cos(theta), 380e9, 0.23, 4000.0, e, mu);
        a.velocity_t = v * sin(theta);
        outcome o = run_impact(&a);
        double e_t = o.vt / a.velocity_t, angle = atan2(o.contact_vt, o.vn) * 180.0 / RIDDLE_PI;
        near_absolute(e_t, table[k][1], 0.02 * 1.0, "tangential restitution");
        near_absolute(-o.spin, table[k][2], 0.02 * 617.0, "spin"); /* the table's spin is about -y */
        near_absolute(angle, table[k][3], 0.02 * 90.0, "rebound angle");
        /* sliding throughout: closed form; the arm is shorter by the overlap, 0.4 % */
        if (table[k][0] < 30.0) continue;
        near_absolute(e_t, 1.0 - mu * (1.0 + e) / tan(theta), 2e-4, "tangential restitution of sliding");
        near_relative(o.spin, 2.5 * mu * (1.0 + e) * v * cos(theta) / r, 6e-3, "spin of sliding");
    }
}

/* The same impact by a plain explicit integration of the equations, in 20000 steps: Hertz without damping, k_t(a) times
   displacement. */
static double plain_recoil(double radius, double young, double poisson, double density, double vn, double mu,
                           double vt) {
    double mass = 4.0 / 3.0 * RIDDLE_PI * radius * radius * radius * density,
           modulus = young / (2.0 * (1.0 - poisson * poisson));
    double shear = young / (2.0 * (1.0 + poisson)) / (2.0 * (2.0 - poisson)),
           stiffness = 4.0 / 3.0 * modulus * sqrt(radius);
    double dt = dem_hertz_contact_time(modulus, radius, mass, vn) / 20000.0, overlap = 0.5 * dt * vn, v = vn, x = vt,
           spin = 0.0, xi = 0.0;
    while (overlap > 0.0) {
        double normal = stiffness * overlap * sqrt(overlap), kt = 8.0 * shear * sqrt(radius * overlap),
               arm = radius - overlap;
        xi += (x - arm * spin) * dt;
        double force = kt * xi, limit = mu * normal;
        if (fabs(force) > limit) force = force > 0.0 ? limit : -limit, xi = force / kt;
        x -= force / mass * dt;
        spin += 2.5 * arm * force / (mass * radius * radius) * dt;
        v -= normal / mass * dt;
        overlap += v * dt;
    }
    return x - radius * spin;
}

/* A law of one's own: an incremental tangential spring with half of Mindlin's stiffness, no damping. */
static double prepare_half(const dem_birth *b, double *constants) {
    const dem_material *m = &b->def->material[b->material_i];
    constants[0] = 4.0 / 3.0 * m->young_modulus / (2.0 * (1.0 - m->poisson_ratio * m->poisson_ratio));
    constants[1] = b->radius_i;
    constants[2] = 4.0 * m->young_modulus / (2.0 * (1.0 + m->poisson_ratio)) / (2.0 * (2.0 - m->poisson_ratio));
    constants[3] = b->pair->friction;
    return 0.0;
}
DEM_INLINE void force_half(const dem_contact *c, double *state, dem_response *r) {
    const double *p = c->constants;
    double overlap = c->gap < 0.0 ? -c->gap : 0.0, area = sqrt(p[1] * overlap), force = p[0] * area * overlap,
           square = 0.0;
    memset(r, 0, sizeof *r);
    r->normal = r->contact = force;
    r->ended = !(c->gap < 0.0);
    r->elastic = 0.4 * force * overlap;
    for (int a = 0; a < 3; a++) state[a] += p[2] * area * c->slip[a] * c->dt, square += state[a] * state[a];
    double scale = p[3] * force / (sqrt(square) + 1e-300);
    for (int a = 0; a < 3; a++) state[a] *= scale < 1.0 ? scale : 1.0, r->tangential[a] = -state[a];
}
static const dem_law law_half = {"half of Mindlin", 1, 3, 3, 1, 8, prepare_half, force_half, NULL, NULL};
DEM_KERNEL(kernel_half, law_half, DEM_FRICTION)

/* The curve of the fifth test cannot come from the law of the fourth: it is, to 0.5 % of full scale, that of half the
   tangential stiffness, which in the fourth test would give 0.53 instead of 0.948 at 5 degrees. docs/dem.md has
   the numbers. */
static void test_chung_ooi_5_recoil(void **state) {
    (void)state;
    static const double steel[10][2] = {{0.33, -0.28}, {0.67, -0.49}, {1.01, -0.75}, {1.66, -1.27}, {2.35, -1.81},
                                        {2.99, -2.44}, {4.01, -2.79}, {5, -2.0},     {6, -1.01},    {10, 3.01}};
    const double mu = 0.3, vn = 5.0, unit = mu * vn, full_scale = 10.0;
    for (int k = 0; k < 10; k++) {
        impact a = plane_impact(1e-5, vn, 208e9, 0.3, 7850.0, 1.0, mu);
        a.velocity_t = steel[k][0] * unit;
        outcome o = run_impact(&a);
        near_absolute(o.contact_vt / unit, plain_recoil(1e-5, 208e9, 0.3, 7850.0, vn, mu, a.velocity_t) / unit, 0.01,
                      "recoil by plain integration");
        if (steel[k][0] >= 6.0) near_absolute(o.contact_vt / unit, steel[k][1], 0.02 * full_scale, "recoil of sliding");
        a.kernel = &kernel_half, a.features = DEM_HERTZ | DEM_FRICTION;
        o = run_impact(&a);
        near_absolute(o.contact_vt / unit, steel[k][1], 0.01 * full_scale, "recoil with half the tangential stiffness");
    }
    for (int k = 8; k <= 14; k += 2) { /* sliding, both materials */
        for (int material = 0; material < 2; material++) {
            impact a = material ? plane_impact(1e-5, vn, 1e9, 0.4, 1400.0, 1.0, mu)
                                : plane_impact(1e-5, vn, 208e9, 0.3, 7850.0, 1.0, mu);
            a.velocity_t = k * unit;
            outcome o = run_impact(&a);
            near_relative(o.vt / unit, k - 2.0, 1e-4, "velocity after sliding");
            /* R omega'/(mu v_n) -> -5, less by the overlap, which shortens the arm: 10 % for polyethylene */
            double modulus = material ? 1e9 / (2.0 * (1.0 - 0.16)) : 208e9 / (2.0 * (1.0 - 0.09)),
                   density = material ? 1400.0 : 7850.0;
            double mass = 4.0 / 3.0 * RIDDLE_PI * 1e-15 * density,
                   overlap = vn * dem_hertz_contact_time(modulus, 1e-5, mass, vn) / 2.943275175395;
            assert_in_range((int)(1000.0 * 1e-5 * o.spin / unit), (int)(5000.0 * (1.0 - overlap / 1e-5)), 5000);
            near_absolute((o.contact_vt - o.vt) / unit, -5.0, 5.0 * overlap / 1e-5, "rotation after sliding");
        }
    }
}

/* Tangential dashpot as strong as the normal one (Tsuji et al. 1992). */
static impact spin_impact(double young, double poisson, double density, double tangent) {
    impact a = plane_impact(0.1, 0.2, young, poisson, density, 0.5, 0.4);
    a.spin = -tangent * 0.2 / 0.1;
    a.tangential_damping = 1.0;
    return a;
}

static void test_chung_ooi_6_spin(void **state) {
    (void)state;
    static const double table[9][2] = {{0.17, 0.06}, {0.36, 0.10}, {0.84, -0.03}, {1.2, -0.27}, {1.73, -0.38},
                                       {2.15, 0.05}, {2.75, 1.27}, {3.73, 3.24},  {5.68, 7.13}};
    for (int k = 0; k < 9; k++) {
        impact a = spin_impact(70e9, 0.33, 2700.0, table[k][0]);
        outcome o = run_impact(&a);
        near_absolute(o.contact_vt / o.vn, table[k][1], 0.02 * 7.5, "recoil");
    }
    for (int k = 4; k <= 10; k++) {
        for (int material = 0; material < 2; material++) { /* aluminium alloy, nylon: the sliding branch is the same */
            impact a = material ? spin_impact(2.5e9, 0.4, 1000.0, k) : spin_impact(70e9, 0.33, 2700.0, k);
            outcome o = run_impact(&a);
            near_absolute(o.contact_vt / o.vn, 2.0 * k - 4.2, 0.02 * 7.5, "recoil of sliding");
            near_relative(o.vn, 0.1, 5e-4, "restitution");
        }
    }
}

static void test_chung_ooi_7_opposite_spins(void **state) {
    (void)state;
    for (int k = 1; k < 8; k++) {
        impact a = spin_impact(70e9, 0.33, 2700.0, k);
        a.other_radius = 0.1, a.other_density = 2700.0, a.other_velocity_n = 0.2, a.other_spin = -a.spin;
        outcome o = run_impact(&a);
        near_relative(o.spin, a.spin, 1e-13, "spin");
        near_relative(o.other_spin, -a.spin, 1e-13, "other spin");
        near_absolute(o.vt, 0.0, 1e-13, "tangential velocity");
        near_relative(o.vn, 0.1, 5e-4, "restitution");
    }
}

static void test_chung_ooi_8_unequal(void **state) {
    (void)state;
    for (int k = 0; k < 8; k++) {
        impact a = spin_impact(70e9, 0.33, 2700.0, 0.5 + k);
        a.other_radius = 0.5, a.other_density = 2.7e6;
        outcome o = run_impact(&a);
        double tangent = o.contact_vt / o.vn;
        if (k >= 3) near_absolute(tangent, 2.0 * (0.5 + k) - 4.2, 0.02 * 7.5, "recoil of sliding");
        impact b = spin_impact(70e9, 0.33, 2700.0, 0.5 + k);
        outcome plane = run_impact(&b);
        /* the time scales are in the same ratio */
        near_absolute(tangent, plane.contact_vt / plane.vn, 0.01 * 7.5, "as on a plane");
    }
}

/* ---- restitution over all phases of the first step ---- */

typedef struct spread {
    double bias, rms, largest;
} spread;

/* n pairs, or n spheres and a plane, all in one world; pair k hits at phase k/n of a step. Linear law. */
static spread phases(double e, dem_restitution mode, int wall, double steps, int n, int features, double slip) {
    dem_world world;
    dem_def def = dem_default_def();
    int m = dem_add_material(&def, 2534.1, 1e9, 0.2);
    dem_pair_def *pair = dem_pair(&def, m, m);
    const double d = 5e-3, k_n = 1e5, v = 0.5, pitch = 4.0 * d;
    double mass = RIDDLE_PI / 6.0 * d * d * d * 2534.1, zeta = dem_damping_ratio(e, mode),
           t_c = dem_contact_time(k_n, wall ? mass : 0.5 * mass, zeta, mode);
    spread s = {0.0, 0.0, 0.0};
    pair->stiffness = k_n, pair->restitution = e, pair->mode = mode, pair->friction = 0.2;
    def.dt = t_c / steps;
    def.gravity = dem_vec3(0, 0, 0);
    assert_int_equal(dem_init(&world, &def, NULL), DEM_OK);
    if (wall) assert_true(dem_add_plane(&world, m, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) == 0);
    for (int k = 0; k < n; k++) {
        double phase = (k + 0.5) / n, gap = v * def.dt * (2.0 + phase),
               at[6] = {pitch * (k % 40), pitch * (k / 40), 0.5 * d + gap,
                        pitch * (k % 40), pitch * (k / 40), -0.5 * d},
               dd[2] = {d, d};
        assert_int_equal(dem_add_spheres(&world, wall ? 1 : 2, at, dd, m, 0), DEM_OK);
        assert_int_equal(dem_set_motion(&world, wall ? k : 2 * k, dem_vec3(slip, 0, -v), dem_vec3(0, 0, 0)), DEM_OK);
    }
    assert_int_equal(dem_run(&world, def.dt * (2.0 * steps + 6.0), features), DEM_OK);
    assert_int_equal(dem_contact_count(&world), 0);
    for (int k = 0; k < n; k++) {
        dem_vec out = dem_velocity(&world, wall ? k : 2 * k);
        if (!wall) out.z -= dem_velocity(&world, 2 * k + 1).z;
        double error = out.z / v / e - 1.0;
        s.bias += error / n, s.rms += error * error / n;
        s.largest = fmax(s.largest, fabs(error));
    }
    s.rms = sqrt(s.rms);
    dem_free(&world);
    return s;
}

static void test_restitution_phases(void **state) {
    (void)state;
    static const double e[2] = {0.7808, 0.4351};
    for (int k = 0; k < 8; k++) {
        const double wanted = e[k / 2 % 2];
        dem_restitution mode = k & 1 ? DEM_NAIVE : DEM_CLIPPED;
        spread s = phases(wanted, mode, k / 4, 20.0, 1000, DEM_LINEAR, 0.0);
        spread coarse = phases(wanted, mode, k / 4, 160.0, 100, DEM_LINEAR, 0.0),
               fine = phases(wanted, mode, k / 4, 640.0, 100, DEM_LINEAR, 0.0);
        double order = log(coarse.rms / fine.rms) / log(4.0);
        print_message("e %.4f %s %s, t_c/20: bias %.1e, rms %.1e, largest %.1e; order %.2f\n", wanted,
                      mode == DEM_NAIVE ? "naive  " : "clipped", k / 4 ? "wall" : "pair", s.bias, s.rms, s.largest,
                      order);
        assert_true(fabs(s.bias) < 1.1e-4 && s.rms < 1.1e-4 && s.largest < 1.4e-4);
        assert_true(order > 2.2 && order < 3.1);
        /* No slip: the same. */
        s = phases(wanted, mode, k / 4, 20.0, 1000, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING, 0.0);
        assert_true(s.largest < 1.4e-4);
    }
}

/* Hertz' dashpot gives its restitution whatever the phase of the first step. */
static void test_hertz_phases(void **state) {
    (void)state;
    static const double restitution[] = {0.1, 0.3, 0.5, 0.7, 0.9, 1.0};
    double worst_bias = 0.0, worst = 0.0;
    for (int k = 0; k < 6; k++) {
        double bias = 0.0;
        for (int q = 0; q < 40; q++) {
            impact a = plane_impact(2.5e-3, 0.5, 5e7, 0.2, 2500.0, restitution[k], 0.0);
            a.steps = 20.0, a.phase = (q + 0.5) / 40.0;
            const double e = run_impact(&a).vn / 0.5 - restitution[k];
            bias += e / 40.0;
            worst = fmax(worst, fabs(e));
        }
        worst_bias = fmax(worst_bias, fabs(bias));
    }
    print_message("Hertz restitution at t_c/20, e = 0.1 .. 1, 40 phases: bias at most %.1e, largest deviation %.1e\n",
                  worst_bias, worst);
    assert_true(worst_bias < 2e-4 && worst < 1.6e-3);
}

/* Oblique hits, linear law with friction and sticking: velocities after against a fine step; second order
   in the step. */
static double oblique_error(double steps, double slip, const double *exact, double *result) {
    double worst = 0.0;
    for (int k = 0; k < 10; k++) {
        dem_world world;
        dem_def def = dem_default_def();
        int m = dem_add_material(&def, 2534.1, 1e9, 0.2);
        dem_pair_def *pair = dem_pair(&def, m, m);
        const double d[2] = {5e-3, 7e-3};
        pair->restitution = 0.7808, pair->friction = 0.3;
        double mass = RIDDLE_PI / 6.0 * 2534.1 / (1.0 / (d[0] * d[0] * d[0]) + 1.0 / (d[1] * d[1] * d[1]));
        double t_c = dem_contact_time(1e5, mass, dem_damping_ratio(0.7808, DEM_CLIPPED), DEM_CLIPPED),
               at[6] = {0, 0, 6e-3, 0, 0, 0};
        def.gravity = dem_vec3(0, 0, 0);
        def.dt = t_c / steps;
        at[2] += t_c / 20.0 * (1.0 + k / 10.0) * 1.0;
        assert_int_equal(dem_init(&world, &def, NULL), DEM_OK);
        assert_int_equal(dem_add_spheres(&world, 2, at, d, m, 0), DEM_OK);
        assert_int_equal(dem_set_motion(&world, 0, dem_vec3(slip, 0, -1.0), dem_vec3(0, 20, 5)), DEM_OK);
        assert_int_equal(dem_run(&world, 4.0 * t_c, DEM_LINEAR | DEM_FRICTION), DEM_OK);
        double out[4] = {dem_velocity(&world, 0).x, dem_velocity(&world, 0).z, dem_spin(&world, 0).y * 2.5e-3,
                         dem_velocity(&world, 1).x};
        for (int a = 0; a < 4; a++) {
            result[4 * k + a] = out[a];
            if (exact) worst = fmax(worst, fabs(out[a] - exact[4 * k + a]));
        }
        dem_free(&world);
    }
    return worst;
}

static void test_oblique_order(void **state) {
    (void)state;
    static const double slip[3] = {0.1, 0.5, 2.5}; /* sticks; slides, then sticks; slides */
    for (int k = 0; k < 3; k++) {
        double exact[40], unused[40], error[3];
        oblique_error(5120.0, slip[k], NULL, exact);
        for (int n = 0; n < 3; n++) error[n] = oblique_error(20.0 * (1 << (2 * n)), slip[k], exact, unused);
        print_message("oblique, slip %.1f m/s: error %.1e m/s at t_c/20, %.1e at t_c/80, %.1e at t_c/320\n", slip[k],
                      error[0], error[1], error[2]);
        assert_true(error[0] < 0.01 && error[2] < error[0] / 16.0);
    }
}

/* A law of one's own with a drag that does not come with the overlap: from 2 um before it to 2 um after. */
enum { DRAGGED = DEM_LINEAR_CONSTANTS };
static double prepare_dragged(const dem_birth *b, double *constants) {
    constants[DRAGGED] = 0.1; /* [N s/m] */
    return dem_prepare_linear(b, constants);
}
DEM_INLINE void force_dragged(const dem_contact *c, double *state, dem_response *r) {
    dem_force_linear_friction(c, state, r);
    const double near = c->gap < 2e-6 ? c->constants[DRAGGED] : 0.0;
    r->ended = near > 0.0 ? 0.0 : 1.0;
    for (int a = 0; a < 3; a++) {
        r->remaining[a] = -near * c->slip[a];
        r->tangential[a] += r->remaining[a];
        r->rolling_power -= r->remaining[a] * c->slip[a];
    }
}
static const dem_law law_dragged = {"linear with drag", 1,    3,   3, 1, DEM_LINEAR_CONSTANTS + 1, prepare_dragged,
                                    force_dragged,      NULL, NULL};
DEM_KERNEL(kernel_dragged, law_dragged, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY)

/* Slip that is left, over that before, of pairs without friction in n phases of the step. */
static void dragged(int n, double steps, double *left, double *ledger) {
    const double d = 5e-3, dd[2] = {d, d}, v = 0.4, slip = 0.3, mass = 2534.1 * RIDDLE_PI / 6.0 * d * d * d;
    const double t_c = dem_contact_time(1e5, 0.5 * mass, dem_damping_ratio(0.7808, DEM_CLIPPED), DEM_CLIPPED);
    dem_world world;
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 2534.1, 1e9, 0.2);
    dem_pair_def *pair = dem_pair(&def, m, m);
    pair->restitution = 0.7808, pair->friction = 0.0;
    def.gravity = dem_vec3(0, 0, 0);
    def.dt = t_c / steps;
    assert_int_equal(dem_init(&world, &def, NULL), DEM_OK);
    for (int k = 0; k < n; k++) {
        const double x = 3.0 * d * k, gap = 4e-6 + v * def.dt * (2.0 + (k + 0.5) / n), at[6] = {x, 0, d + gap, x, 0, 0};
        assert_int_equal(dem_add_spheres(&world, 2, at, dd, m, 0), DEM_OK);
        assert_int_equal(dem_set_motion(&world, 2 * k, dem_vec3(slip, 0, -v), dem_vec3(0, 0, 0)), DEM_OK);
    }
    assert_int_equal(dem_run_law(&world, 3.0 * t_c, &kernel_dragged), DEM_OK);
    for (int k = 0; k < n; k++) {
        const double spins = 0.5 * d * (dem_spin(&world, 2 * k).y + dem_spin(&world, 2 * k + 1).y);
        left[k] = (dem_velocity(&world, 2 * k).x - dem_velocity(&world, 2 * k + 1).x - spins) / slip;
    }
    const dem_energy_ledger l = dem_energy(&world);
    *ledger = fabs(l.error) / l.start;
    dem_free(&world);
}

/* Drag has no part in the impulse of the contact: that over its force, which may be next to nothing, would be the time
   it acts for. */
static void test_drag_phases(void **state) {
    (void)state;
    enum { PHASES = 1000 };
    double left[PHASES], exact, ledger, worst = 0.0;
    dragged(1, 2000.0, &exact, &ledger);
    dragged(PHASES, 8.0, left, &ledger);
    for (int k = 0; k < PHASES; k++) worst = fmax(worst, fabs(left[k] - exact));
    print_message("drag: slip left %.4f, at t_c/8 largest deviation %.1e, ledger %.1e\n", exact, worst, ledger);
    assert_true(exact > 0.6 && exact < 0.7 && worst < 0.04 && ledger < 2e-3);
}

/* ---- momentum, angular momentum, energy ---- */

/* A cloud that falls into itself, frictional and damped; no walls. */
static void collapse(dem_world *world, int features, double e) {
    scene_random r = {11};
    dem_def def = dem_default_def();
    int m = dem_add_material(&def, 2534.1, 5e7, 0.2);
    const double sizes[3] = {5e-3, 7e-3, 10e-3};
    dem_pair_def *pair = dem_pair(&def, m, m);
    pair->restitution = e, pair->friction = 0.4, pair->rolling = 1e-4;
    def.gravity = dem_vec3(0, 0, 0);
    def.dt = 4e-6;
    assert_int_equal(dem_init(world, &def, NULL), DEM_OK);
    assert_int_equal(scene_fill(world, &r, 4, 4, 4, dem_vec3(-0.022, -0.022, -0.022), 0.011, sizes, 3, 0.3), DEM_OK);
    for (ptrdiff_t i = 0; i < world->count; i++) {
        dem_vec x = dem_position(world, i), v = dem_velocity(world, i);
        dem_set_motion(world, i, dem_vec3(v.x - 80.0 * x.x, v.y - 80.0 * x.y, v.z - 80.0 * x.z),
                       scene_vector(&r, 60.0));
    }
    assert_int_equal(dem_run(world, 0.0, features), DEM_OK);
}

static dem_vec angular_momentum(const dem_world *w, double *size) {
    dem_vec sum = dem_vec3(0, 0, 0);
    *size = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dem_vec x = dem_position(w, i), v = dem_velocity(w, i);
        double m = dem_mass(w, i), inertia = 0.4 * m * dem_radius(w, i) * dem_radius(w, i);
        dem_vec l = dem_vec3(m * (x.y * v.z - x.z * v.y) + inertia * dem_spin(w, i).x,
                             m * (x.z * v.x - x.x * v.z) + inertia * dem_spin(w, i).y,
                             m * (x.x * v.y - x.y * v.x) + inertia * dem_spin(w, i).z);
        sum = dem_vec3(sum.x + l.x, sum.y + l.y, sum.z + l.z);
        *size += sqrt(l.x * l.x + l.y * l.y + l.z * l.z);
    }
    return sum;
}

static void test_momentum(void **state) {
    (void)state;
    static const int features[4] = {DEM_LINEAR, DEM_LINEAR | DEM_FRICTION, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING,
                                    DEM_HERTZ | DEM_FRICTION | DEM_ROLLING};
    for (int k = 0; k < 4; k++) {
        dem_world world;
        double scale, sum = 0.0;
        collapse(&world, features[k], 0.8);
        dem_vec p = dem_momentum(&world), l = angular_momentum(&world, &scale);
        for (ptrdiff_t i = 0; i < world.count; i++) {
            dem_vec v = dem_velocity(&world, i);
            sum += dem_mass(&world, i) * sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
        }
        assert_int_equal(dem_run(&world, 0.03, features[k]), DEM_OK);
        dem_vec p2 = dem_momentum(&world), l2 = angular_momentum(&world, &scale);
        double dp = fabs(p2.x - p.x) + fabs(p2.y - p.y) + fabs(p2.z - p.z),
               dl = fabs(l2.x - l.x) + fabs(l2.y - l.y) + fabs(l2.z - l.z);
        print_message("%ld contact steps: momentum kept to %.1e, angular momentum to %.1e\n", (long)world.contact_steps,
                      dp / sum, dl / scale);
        assert_true(world.contact_steps > 5000);
        assert_true(dp < 1e-14 * sum);
        assert_true(dl < 1e-7 * scale); /* to round-off where a particle has one contact at a time: test_dem.c */
        dem_free(&world);
    }
}

/* Frictionless elastic spheres in a box; every step at t_c/200. */
static void test_elastic_energy(void **state) {
    (void)state;
    for (int hertz = 0; hertz < 2; hertz++) {
        dem_world world;
        scene_random r = {5};
        dem_def def = scene_def(1.0);
        const double sizes[3] = {5e-3, 7e-3, 10e-3};
        int features = (hertz ? DEM_HERTZ : DEM_LINEAR) | DEM_ENERGY;
        dem_pair(&def, 0, 0)->restitution = dem_pair(&def, 0, 1)->restitution = 1.0;
        assert_int_equal(dem_init(&world, &def, NULL), DEM_OK);
        scene_box(&world, 0.02, 0.0, 0.06);
        assert_int_equal(scene_fill(&world, &r, 3, 3, 4, dem_vec3(-0.018, -0.018, 0.002), 0.012, sizes, 3, 0.5),
                         DEM_OK);
        dem_free(&world);
        def.dt = 1e-6;
        assert_int_equal(dem_init(&world, &def, NULL), DEM_OK);
        scene_box(&world, 0.02, 0.0, 0.06);
        r.state = 5;
        assert_int_equal(scene_fill(&world, &r, 3, 3, 4, dem_vec3(-0.018, -0.018, 0.002), 0.012, sizes, 3, 0.5),
                         DEM_OK);
        double t_c = dem_advise(&world, features, 1.0).contact;
        assert_int_equal(dem_set_time_step(&world, t_c / 200.0), DEM_OK);
        assert_int_equal(dem_run(&world, 0.05, features), DEM_OK);
        dem_energy_ledger l = dem_energy(&world);
        double error = fabs(l.error) / (l.start - l.start_potential + l.released);
        print_message("%s, elastic, t_c/200, %ld contact steps: ledger open by %.1e\n", hertz ? "Hertz" : "linear",
                      (long)world.contact_steps, error);
        assert_true(world.contact_steps > 10000);
        assert_true(error < 1e-6);
        assert_true(fabs(l.normal_loss) < 1e-6 * l.start && l.sliding_loss == 0.0 && l.wall_work == 0.0);
        dem_free(&world);
    }
}

/* With damping, friction and rolling, at t_c/20 and t_c/80. */
static void test_damped_energy(void **state) {
    (void)state;
    static const int features[4] = {DEM_LINEAR, DEM_LINEAR | DEM_FRICTION, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING,
                                    DEM_HERTZ | DEM_FRICTION | DEM_ROLLING};
    for (int k = 0; k < 4; k++) {
        double error[2];
        for (int n = 0; n < 2; n++) {
            dem_world world;
            collapse(&world, features[k] | DEM_ENERGY, 0.8);
            double t_c = dem_advise(&world, features[k], 1.0).contact;
            assert_int_equal(dem_set_time_step(&world, t_c / (n ? 80.0 : 20.0)), DEM_OK);
            assert_int_equal(dem_run(&world, 0.03, features[k] | DEM_ENERGY), DEM_OK);
            dem_energy_ledger l = dem_energy(&world);
            error[n] = fabs(l.error) / l.start;
            assert_true(l.normal_loss > 0.05 * l.start);
            if (k > 0) assert_true(l.sliding_loss > 0.01 * l.start);
            if (k > 1) assert_true(l.rolling_loss > 0.001 * l.start);
            dem_free(&world);
        }
        print_message("damped, features %d: ledger open by %.1e at t_c/20, %.1e at t_c/80\n", features[k], error[0],
                      error[1]);
        assert_true(error[0] < 5e-3 && error[1] < 1e-3);
    }
}

/* ---- a sphere bouncing on a vibrating plane: flights by root finding, contacts by the damped oscillator's
   closed form ---- */

typedef struct bouncer {
    double k, gamma, mass, g, amplitude, rate, phase;
} bouncer;

static double floor_at(const bouncer *b, double t) {
    return b->amplitude * (sin(b->rate * t + b->phase) - sin(b->phase));
}
static double floor_speed(const bouncer *b, double t) { return b->amplitude * b->rate * cos(b->rate * t + b->phase); }

/* Gap and its rate at a time t of a contact that began at t0 with gap 0 and rate u. */
static void in_contact(const bouncer *b, double t0, double u, double t, double *gap, double *rate) {
    double omega0 = sqrt(b->k / b->mass), zeta = 0.5 * b->gamma / sqrt(b->k * b->mass),
           omega = omega0 * sqrt(1.0 - zeta * zeta), w = b->rate;
    double real = omega0 * omega0 - w * w, imaginary = 2.0 * zeta * omega0 * w,
           size = b->amplitude * w * w / sqrt(real * real + imaginary * imaginary);
    double lag = atan2(imaginary, real), p0 = size * sin(w * t0 + b->phase - lag) - b->g / (omega0 * omega0),
           q0 = size * w * cos(w * t0 + b->phase - lag);
    double c = -p0, s = (u - q0 + zeta * omega0 * c) / omega, tau = t - t0, decay = exp(-zeta * omega0 * tau);
    *gap = decay * (c * cos(omega * tau) + s * sin(omega * tau)) + size * sin(w * t + b->phase - lag) -
           b->g / (omega0 * omega0);
    *rate = decay * ((s * omega - zeta * omega0 * c) * cos(omega * tau) -
                     (c * omega + zeta * omega0 * s) * sin(omega * tau)) +
            size * w * cos(w * t + b->phase - lag);
}

/* Height of the bottom of the sphere at t_end; *hits counts. */
static double bounce(const bouncer *b, double z, double v, double t_end, int clipped, int *hits) {
    double t = 0.0, t_c = RIDDLE_PI * sqrt(b->mass / b->k);
    for (*hits = 0;; ++*hits) {
        double step = 1e-5, s = 0.0, low, high; /* flight: scan, then bisect */
        while (t + s < t_end && z + v * s - 0.5 * b->g * s * s - floor_at(b, t + s) >= 0.0) s += step;
        if (t + s >= t_end && z + v * (t_end - t) - 0.5 * b->g * (t_end - t) * (t_end - t) >= floor_at(b, t_end))
            return z + v * (t_end - t) - 0.5 * b->g * (t_end - t) * (t_end - t);
        for (low = s - step, high = s; high - low > 1e-16;) {
            double m = 0.5 * (low + high);
            if (m == low || m == high) break;
            if (z + v * m - 0.5 * b->g * m * m - floor_at(b, t + m) >= 0.0) low = m;
            else high = m;
        }
        t += high, v -= b->g * high;
        double t0 = t, u = v - floor_speed(b, t), gap, rate;
        for (s = 0.01 * t_c;; s += 0.01 * t_c) { /* contact */
            in_contact(b, t0, u, t0 + s, &gap, &rate);
            if (clipped ? -b->k * gap - b->gamma * rate <= 0.0 : gap >= 0.0) break;
        }
        for (low = s - 0.01 * t_c, high = s; high - low > 1e-18;) {
            double m = 0.5 * (low + high);
            if (m == low || m == high) break;
            in_contact(b, t0, u, t0 + m, &gap, &rate);
            if (clipped ? -b->k * gap - b->gamma * rate <= 0.0 : gap >= 0.0) high = m;
            else low = m;
        }
        in_contact(b, t0, u, t0 + high, &gap, &rate);
        t = t0 + high, z = gap + floor_at(b, t), v = rate + floor_speed(b, t);
        if (clipped) { /* the floor may fall away faster: free until the gap opens, as the parabola says */
            while (z - floor_at(b, t) < 0.0) {
                double h = 1e-8;
                z += v * h - 0.5 * b->g * h * h, v -= b->g * h, t += h;
            }
        }
    }
}

static void test_vibrating_plane(void **state) {
    (void)state;
    for (int mode = 0; mode < 2; mode++) {
        double error[2];
        int hits = 0;
        for (int n = 0; n < 2; n++) {
            dem_world world;
            dem_def def = dem_default_def();
            int m = dem_add_material(&def, 2534.1, 1e9, 0.2);
            dem_pair_def *pair = dem_pair(&def, m, m);
            const double d = 5e-3, at[3] = {0.3, -0.2, 2.5e-3 + 2e-3}, t_end = 0.25;
            bouncer b = {1e5, 0.0, RIDDLE_PI / 6.0 * 5e-3 * 5e-3 * 5e-3 * 2534.1, 9.81, 1e-3, 2.0 * RIDDLE_PI * 30.0,
                         0.4};
            pair->restitution = 0.6, pair->mode = mode ? DEM_NAIVE : DEM_CLIPPED;
            double zeta = dem_damping_ratio(0.6, pair->mode);
            b.gamma = 2.0 * zeta * sqrt(b.k * b.mass);
            def.dt = dem_contact_time(b.k, b.mass, zeta, pair->mode) / (n ? 80.0 : 20.0);
            assert_int_equal(dem_init(&world, &def, NULL), DEM_OK);
            int plane = dem_add_plane(&world, m, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
            assert_int_equal(dem_vibrate(&world, plane, dem_vec3(0, 0, b.amplitude), dem_vec3(0, 0, b.phase), 30.0),
                             DEM_OK);
            assert_int_equal(dem_add_spheres(&world, 1, at, &d, m, 0), DEM_OK);
            assert_int_equal(dem_run(&world, t_end, DEM_LINEAR), DEM_OK);
            error[n] = dem_position(&world, 0).z - 2.5e-3 - bounce(&b, 2e-3, 0.0, world.time, !mode, &hits);
            assert_true(dem_position(&world, 0).x == 0.3 && dem_position(&world, 0).y == -0.2);
            dem_free(&world);
        }
        print_message("vibrating plane, %s, %d hits: off by %.1e m at t_c/20, %.1e m at t_c/80\n",
                      mode ? "naive" : "clipped", hits, error[0], error[1]);
        assert_in_range(hits, 5, 60);
        assert_true(fabs(error[0]) < 2e-5 && fabs(error[1]) < 2e-6);
    }
}

/* ---- the beds ---- */

typedef struct bed {
    ptrdiff_t n;
    double *x, *v, *w; /* [n][3] */
} bed;

static bed read_bed(const char *name, ptrdiff_t n) {
    bed b = {n, malloc((size_t)n * 3 * sizeof(double)), malloc((size_t)n * 3 * sizeof(double)),
             malloc((size_t)n * 3 * sizeof(double))};
    char line[512];
    FILE *file = fopen(name, "r");
    assert_non_null(file);
    assert_true(fgets(line, sizeof line, file) && fgets(line, sizeof line, file)); /* a comment and the column names */
    for (ptrdiff_t i = 0; i < n; i++) {
        double *x = b.x + 3 * i, *v = b.v + 3 * i, *w = b.w + 3 * i;
        assert_true(fgets(line, sizeof line, file) != NULL);
        assert_int_equal(
            sscanf(line, "%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", x, x + 1, x + 2, v, v + 1, v + 2, w, w + 1, w + 2), 9);
    }
    fclose(file);
    return b;
}

static void free_bed(bed *b) { free(b->x), free(b->v), free(b->w); }

static const double bed_d = 5e-3, bed_k = 1e5, bed_density = 2534.0, bed_mu = 0.2, bed_dt = 4e-6;

/* An integrator of its own: velocities at half steps, forces from them (as LAMMPS's granular styles do), a pair list
   from sorting by height, dashpots by their rates. It shares no line with dem.h. */
typedef struct slow_pair {
    int i, j;
    double xi[3];
} slow_pair;

static const double *slow_heights;
static int slow_compare(const void *a, const void *b) {
    double d = slow_heights[3 * *(const int *)a + 2] - slow_heights[3 * *(const int *)b + 2];
    return d < 0.0 ? -1 : d > 0.0;
}

static void slow_force(const double *n, double gap, const double *v, double gamma, double kt, double m, double *xi,
                       double *f, double *torque_arm) {
    double vn = v[0] * n[0] + v[1] * n[1] + v[2] * n[2], normal = -bed_k * gap - gamma * m * vn,
           along = xi[0] * n[0] + xi[1] * n[1] + xi[2] * n[2], size = 0.0, t[3];
    for (int a = 0; a < 3; a++) {
        xi[a] += bed_dt * (v[a] - vn * n[a]) - along * n[a];
        t[a] = -kt * xi[a];
        size += t[a] * t[a];
    }
    size = sqrt(size);
    double limit = bed_mu * fabs(normal);
    for (int a = 0; a < 3; a++) {
        if (size > limit) t[a] *= limit / size, xi[a] = -t[a] / kt;
        f[a] = normal * n[a] + t[a];
    }
    torque_arm[0] = n[1] * t[2] - n[2] * t[1], torque_arm[1] = n[2] * t[0] - n[0] * t[2],
    torque_arm[2] = n[0] * t[1] - n[1] * t[0];
}

static void slow_run(bed *b, double side, double amplitude, int steps) {
    const ptrdiff_t n = b->n;
    const double r = 0.5 * bed_d, m = RIDDLE_PI / 6.0 * bed_d * bed_d * bed_d * bed_density, inertia = 0.4 * m * r * r,
                 kt = 2.0 / 7.0 * bed_k, reach = 1.2 * bed_d;
    double *f = calloc((size_t)n * 3, sizeof *f), *t = calloc((size_t)n * 3, sizeof *t),
           *at = malloc((size_t)n * 3 * sizeof *at), *wall = calloc((size_t)n * 3, sizeof *wall);
    int *order = malloc((size_t)n * sizeof *order), *start = calloc((size_t)n + 1, sizeof *start);
    slow_pair *pairs = NULL, *old;
    ptrdiff_t count = 0, room = 0;
    for (int s = 0; s <= steps; s++) {
        double moved = HUGE_VAL;
        for (ptrdiff_t k = 0; s > 0 && k < 3 * n; k++) { /* half kick and drift; step 0 only finds the forces */
            b->v[k] += 0.5 * bed_dt * (f[k] / m - (k % 3 == 2 ? 9.81 : 0.0));
            b->w[k] += 0.5 * bed_dt * t[k] / inertia;
            b->x[k] += bed_dt * b->v[k];
        }
        for (ptrdiff_t k = 0; s > 0 && k < 3 * n; k++)
            moved = k == 0 ? fabs(b->x[k] - at[k]) : fmax(moved, fabs(b->x[k] - at[k]));
        if (moved > 0.05 * bed_d) {
            ptrdiff_t olds = count;
            int *begin = start;
            old = pairs, pairs = NULL, count = room = 0;
            for (ptrdiff_t i = 0; i < n; i++) order[i] = (int)i;
            memcpy(at, b->x, (size_t)n * 3 * sizeof *at);
            slow_heights = at;
            qsort(order, (size_t)n, sizeof *order, slow_compare);
            for (ptrdiff_t p = 0; p < n; p++) {
                for (ptrdiff_t q = p + 1; q < n && at[3 * order[q] + 2] - at[3 * order[p] + 2] < reach; q++) {
                    double d[3], square = 0.0;
                    for (int a = 0; a < 3; a++) {
                        d[a] = at[3 * order[p] + a] - at[3 * order[q] + a];
                        if (a < 2) d[a] -= side * floor(d[a] / side + 0.5);
                        square += d[a] * d[a];
                    }
                    if (square > reach * reach) continue;
                    if (count == room) pairs = realloc(pairs, (size_t)(room = 2 * room + 1000) * sizeof *pairs);
                    slow_pair fresh = {order[p] < order[q] ? order[p] : order[q],
                                       order[p] < order[q] ? order[q] : order[p],
                                       {0, 0, 0}};
                    for (int o = begin[fresh.i]; olds > 0 && o < begin[fresh.i + 1]; o++)
                        if (old[o].j == fresh.j) fresh = old[o];
                    pairs[count++] = fresh;
                }
            }
            free(old);
            /* by the first partner, so that histories are found again */
            memset(start, 0, (size_t)(n + 1) * sizeof *start);
            for (ptrdiff_t p = 0; p < count; p++) start[pairs[p].i + 1]++;
            for (ptrdiff_t i = 0; i < n; i++) start[i + 1] += start[i];
            slow_pair *sorted = malloc((size_t)count * sizeof *sorted);
            int *next = malloc((size_t)n * sizeof *next);
            memcpy(next, start, (size_t)n * sizeof *next);
            for (ptrdiff_t p = 0; p < count; p++) sorted[next[pairs[p].i]++] = pairs[p];
            free(next), free(pairs);
            pairs = sorted;
            room = count;
        }
        memset(f, 0, (size_t)n * 3 * sizeof *f), memset(t, 0, (size_t)n * 3 * sizeof *t);
        for (ptrdiff_t p = 0; p < count; p++) {
            slow_pair *q = &pairs[p];
            const double *xi = b->x + 3 * q->i, *xj = b->x + 3 * q->j, *vi = b->v + 3 * q->i, *vj = b->v + 3 * q->j,
                         *wi = b->w + 3 * q->i, *wj = b->w + 3 * q->j;
            double d[3], g[3], force[3], arm[3], square = 0.0;
            for (int a = 0; a < 3; a++) {
                d[a] = xi[a] - xj[a];
                if (a < 2) d[a] -= side * floor(d[a] / side + 0.5);
                square += d[a] * d[a];
            }
            if (square >= bed_d * bed_d) {
                q->xi[0] = q->xi[1] = q->xi[2] = 0.0;
                continue;
            }
            double distance = sqrt(square), s2[3];
            for (int a = 0; a < 3; a++) d[a] /= distance, s2[a] = 0.5 * distance * (wi[a] + wj[a]);
            for (int a = 0; a < 3; a++)
                g[a] = vi[a] - vj[a] + d[(a + 1) % 3] * s2[(a + 2) % 3] - d[(a + 2) % 3] * s2[(a + 1) % 3];
            slow_force(d, distance - bed_d, g, 5475.7, kt, 0.5 * m, q->xi, force, arm);
            for (int a = 0; a < 3; a++) {
                f[3 * q->i + a] += force[a], f[3 * q->j + a] -= force[a];
                t[3 * q->i + a] -= 0.5 * distance * arm[a], t[3 * q->j + a] -= 0.5 * distance * arm[a];
            }
        }
        double rate = 2.0 * RIDDLE_PI * 50.6, floor_z = amplitude * (1.0 - cos(rate * s * bed_dt)),
               floor_v = amplitude * rate * sin(rate * s * bed_dt);
        for (ptrdiff_t i = 0; i < n; i++) {
            double up[3] = {0, 0, 1}, gap = b->x[3 * i + 2] - floor_z - r, *w = b->w + 3 * i, *v = b->v + 3 * i,
                   arm_length = r + gap, force[3], arm[3];
            double g[3] = {v[0] - arm_length * w[1], v[1] + arm_length * w[0], v[2] - floor_v};
            if (gap >= 0.0) {
                wall[3 * i] = wall[3 * i + 1] = wall[3 * i + 2] = 0.0;
                continue;
            }
            slow_force(up, gap, g, 3871.9, kt, m, wall + 3 * i, force, arm);
            for (int a = 0; a < 3; a++) f[3 * i + a] += force[a], t[3 * i + a] -= arm_length * arm[a];
        }
        for (ptrdiff_t k = 0; s > 0 && k < 3 * n; k++) {
            b->v[k] += 0.5 * bed_dt * (f[k] / m - (k % 3 == 2 ? 9.81 : 0.0));
            b->w[k] += 0.5 * bed_dt * t[k] / inertia;
        }
    }
    free(f), free(t), free(at), free(wall), free(order), free(start), free(pairs);
}

static void fast_run(bed *b, double side, double amplitude, int steps) {
    dem_world world;
    dem_def def = dem_default_def();
    int glass = dem_add_material(&def, bed_density, 1e9, 0.2), base = dem_add_material(&def, bed_density, 1e9, 0.2);
    double *d = malloc((size_t)b->n * sizeof *d), m = RIDDLE_PI / 6.0 * bed_d * bed_d * bed_d * bed_density;
    for (ptrdiff_t i = 0; i < b->n; i++) d[i] = bed_d;
    for (int k = 0; k < 2; k++) {
        dem_pair_def *p = dem_pair(&def, glass, k ? base : glass);
        double meff = k ? m : 0.5 * m, gamma = (k ? 3871.9 : 5475.7) * meff;
        p->mode = DEM_NAIVE, p->friction = bed_mu, p->stiffness = bed_k;
        p->restitution = dem_restitution_of(0.5 * gamma / sqrt(bed_k * meff), DEM_NAIVE);
        near_relative(p->restitution, 0.78, 2e-3, "the bed's restitution");
        near_relative(dem_contact_time(bed_k, meff, 0.5 * gamma / sqrt(bed_k * meff), DEM_NAIVE),
                      k ? 128.4e-6 : 90.8e-6, 1e-3, "the bed's contact time");
    }
    def.dt = bed_dt;
    def.periodic[0] = def.periodic[1] = 1;
    def.high = dem_vec3(side, side, 1.0);
    assert_int_equal(dem_init(&world, &def, NULL), DEM_OK);
    assert_int_equal(dem_add_spheres(&world, b->n, b->x, d, glass, 0), DEM_OK);
    for (ptrdiff_t i = 0; i < b->n; i++) {
        const double *v = b->v + 3 * i, *w = b->w + 3 * i;
        assert_int_equal(dem_set_motion(&world, i, dem_vec3(v[0], v[1], v[2]), dem_vec3(w[0], w[1], w[2])), DEM_OK);
    }
    int plane = dem_add_plane(&world, base, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
    assert_int_equal(dem_vibrate(&world, plane, dem_vec3(0, 0, amplitude), dem_vec3(0, 0, -0.5 * RIDDLE_PI), 50.6),
                     DEM_OK);
    assert_int_equal(dem_run(&world, steps * bed_dt, DEM_LINEAR | DEM_FRICTION), DEM_OK);
    assert_int_equal(world.step, steps);
    for (ptrdiff_t i = 0; i < b->n; i++) {
        dem_vec x = dem_position(&world, i), v = dem_velocity(&world, i);
        b->x[3 * i] = x.x, b->x[3 * i + 1] = x.y, b->x[3 * i + 2] = x.z;
        b->v[3 * i] = v.x, b->v[3 * i + 1] = v.y, b->v[3 * i + 2] = v.z;
    }
    free(d);
    dem_free(&world);
}

static double bed_height(const bed *b) {
    double sum = 0.0;
    for (ptrdiff_t i = 0; i < b->n; i++) sum += b->x[3 * i + 2];
    return sum / (double)b->n;
}
static double bed_kinetic(const bed *b) {
    double sum = 0.0;
    for (ptrdiff_t k = 0; k < 3 * b->n; k++) sum += b->v[k] * b->v[k];
    return 0.5 * RIDDLE_PI / 6.0 * bed_d * bed_d * bed_d * bed_density * sum;
}

static void compare_beds(const char *file, ptrdiff_t n, double side, double amplitude, int steps) {
    bed slow = read_bed(file, n), fast = read_bed(file, n);
    slow_run(&slow, side, amplitude, steps);
    fast_run(&fast, side, amplitude, steps);
    double z = bed_height(&slow), e = bed_kinetic(&slow), dz = bed_height(&fast) - z, de = bed_kinetic(&fast) / e - 1.0;
    print_message(
        "bed of %ld, A = %g mm, %d steps: mean height %.7f m, off by %.1e; kinetic energy %.6g J, off by %.2f %%\n",
        (long)n, 1e3 * amplitude, steps, z, dz, e, 100.0 * de);
    assert_true(fabs(dz) < 1e-7);
    assert_true(fabs(de) < (amplitude > 0.0 ? 1e-3 : 1e-2));
    free_bed(&slow), free_bed(&fast);
}

static void test_bed_vibrated(void **state) {
    (void)state;
    compare_beds("tests/reference/beds/settled_2000.csv", 2000, 0.045, 1e-3, 500);
    compare_beds("tests/reference/beds/settled_2000.csv", 2000, 0.045, 1e-3, 2000);
}
static void test_bed_static(void **state) {
    (void)state;
    compare_beds("tests/reference/beds/settled_2000.csv", 2000, 0.045, 0.0, 500);
}
static void test_bed_large(void **state) {
    (void)state;
    compare_beds("tests/reference/beds/settled_20000.csv", 20000, 0.14, 1e-3, 200);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_chung_ooi_1_pair),
        cmocka_unit_test(test_chung_ooi_2_plane),
        cmocka_unit_test(test_chung_ooi_3_restitution),
        cmocka_unit_test(test_chung_ooi_4_oblique),
        cmocka_unit_test(test_chung_ooi_5_recoil),
        cmocka_unit_test(test_chung_ooi_6_spin),
        cmocka_unit_test(test_chung_ooi_7_opposite_spins),
        cmocka_unit_test(test_chung_ooi_8_unequal),
        cmocka_unit_test(test_restitution_phases),
        cmocka_unit_test(test_hertz_phases),
        cmocka_unit_test(test_oblique_order),
        cmocka_unit_test(test_drag_phases),
        cmocka_unit_test(test_momentum),
        cmocka_unit_test(test_elastic_energy),
        cmocka_unit_test(test_damped_energy),
        cmocka_unit_test(test_vibrating_plane),
        cmocka_unit_test(test_bed_vibrated),
        cmocka_unit_test(test_bed_static),
        cmocka_unit_test(test_bed_large),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
