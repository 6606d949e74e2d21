/* dem.h: measuring: volumes in regions, stress, coarse-grained fields, histograms, residence, mixing. */
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

static const double nan_ = (double)NAN, inf = (double)INFINITY, g = 9.81;

static dem_vec v3(double x, double y, double z) { return dem_vec3(x, y, z); }

static dem_def soft_def(void) {
    dem_def def = dem_default_def();
    dem_add_material(&def, 2500.0, 1e7, 0.2);
    dem_pair_def *p = dem_pair(&def, 0, 0);
    p->stiffness = 1e4, p->restitution = 0.3, p->friction = 0.5, p->rolling = 1e-4;
    def.dt = 2e-5; /* 5 mm: a contact takes 33 steps */
    return def;
}
static void start(dem_world *w, const dem_def *def) { assert_int_equal(dem_init(w, def, NULL), DEM_OK); }
static void add(dem_world *w, dem_vec at, double d, int group) {
    assert_int_equal(dem_add_spheres(w, 1, &at.x, &d, 0, group), DEM_OK);
}
static void run(dem_world *w, double t) {
    assert_int_equal(dem_run(w, t, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING), DEM_OK);
}

/* ---- volumes ---- */

/* Columns of the ball over a fine grid of the box's base. */
static double summed_volume(dem_vec low, dem_vec high) {
    const int n = 600;
    double sum = 0.0;
    for (int a = 0; a < n; a++) {
        for (int b = 0; b < n; b++) {
            const double x = low.x + (high.x - low.x) * (a + 0.5) / n, y = low.y + (high.y - low.y) * (b + 0.5) / n,
                         square = 1.0 - x * x - y * y;
            const double half = square > 0.0 ? sqrt(square) : 0.0, from = fmax(low.z, -half), to = fmin(high.z, half);
            sum += to > from ? to - from : 0.0;
        }
    }
    return sum * (high.x - low.x) * (high.y - low.y) / (double)(n * n);
}

static void test_ball_in_box(void **state) {
    (void)state;
    const double ball = 4.0 / 3.0 * RIDDLE_PI;
    near_relative(dem_ball_in_box(1.0, v3(-1, -1, -1), v3(1, 1, 1)), ball, 1e-14, "whole");
    near_relative(dem_ball_in_box(3.0, v3(-30, -30, -30), v3(30, 30, 30)), 27.0 * ball, 1e-14, "whole");
    near_relative(dem_ball_in_box(1.0, v3(0, 0, 0), v3(1, 2, 3)), ball / 8.0, 1e-14, "octant");
    near_relative(dem_ball_in_box(1.0, v3(-2, 0, 0), v3(2, 2, 2)), ball / 4.0, 1e-14, "quarter");
    near_relative(dem_ball_in_box(1.0, v3(-0.1, -0.2, -0.3), v3(0.4, 0.3, 0.2)), 0.125, 1e-13, "box within");
    for (double c = -0.99; c < 1.0; c += 0.03)
        near_absolute(dem_ball_in_box(1.0, v3(-2, c, -2), v3(2, 2, 2)),
                      RIDDLE_PI / 3.0 * (1.0 - c) * (1.0 - c) * (2.0 + c), 1e-14, "cap");
    assert_true(dem_ball_in_box(1.0, v3(0.7, 0.7, 0.3), v3(2, 2, 2)) == 0.0);
    scene_random r = {4};
    for (int k = 0; k < 60; k++) {
        dem_vec low, high;
        for (int a = 0; a < 3; a++) {
            const double u = scene_between(&r, -1.2, 1.2), v = scene_between(&r, -1.2, 1.2);
            *dem_axis_of(&low, a) = fmin(u, v), *dem_axis_of(&high, a) = fmax(u, v);
        }
        if (k < 12) near_absolute(dem_ball_in_box(1.0, low, high), summed_volume(low, high), 2e-4, "against columns");
        /* the parts of a box that is cut add up */
        double sum = 0.0;
        for (int c = 0; c < 27; c++) {
            dem_vec from = low, to = high;
            for (int a = 0, code = c; a < 3; a++, code /= 3) {
                const double size = (dem_axis(high, a) - dem_axis(low, a)) / 3.0;
                *dem_axis_of(&from, a) = dem_axis(low, a) + code % 3 * size;
                *dem_axis_of(&to, a) = code % 3 == 2 ? dem_axis(high, a) : dem_axis(low, a) + (code % 3 + 1) * size;
            }
            sum += dem_ball_in_box(1.0, from, to);
        }
        near_absolute(sum, dem_ball_in_box(1.0, low, high), 1e-13, "parts");
    }
    assert_true(isnan(dem_ball_in_box(nan_, v3(0, 0, 0), v3(1, 1, 1))) &&
                isnan(dem_ball_in_box(1.0, v3(1, 0, 0), v3(0, 1, 1))));
    assert_true(isnan(dem_ball_in_box(1.0, v3(nan_, 0, 0), v3(1, 1, 1))) &&
                dem_ball_in_box(1e-90, v3(0, 0, 0), v3(inf, inf, inf)) > 0.0);
}

static double solid_volume(const dem_world *w, dem_region region) {
    dem_measure m = {0};
    assert_int_equal(dem_measure_region(w, &region, &m), DEM_OK);
    return m.solid_fraction * dem_region_volume(&region);
}

/* Polyhedra that a region cuts count by what is within, without the sphere around them: parts add up, a tetrahedron is
   cut at its tip, cubes that lie flush with the region count whole. */
static void test_solid_polyhedra(void **state) {
    (void)state;
    const double a = 0.003, corners[12] = {0, 0, 0, a, 0, 0, 0, a, 0, 0, 0, a}, turned[4] = {0.3, -0.5, 0.7, 0.2};
    const double at[9] = {0.5 * a, 0.5 * a, 0.5 * a, 1.5 * a, 0.5 * a, 0.5 * a, 0.02, 0.02, 0.02};
    dem_convex cube, tip;
    dem_world w;
    dem_def def = soft_def();
    start(&w, &def);
    assert_int_equal(dem_make_brick(&cube, v3(a, a, a), 0.05, NULL), DEM_OK);
    assert_int_equal(dem_make_convex(&tip, 4, corners, 0.05, NULL), DEM_OK);
    const int brick = dem_add_shape(&w, &cube), tetrahedron = dem_add_shape(&w, &tip);
    assert_int_equal(dem_add_convex(&w, brick, 2, at, NULL, 0, 0), DEM_OK);
    const double volume = a * a * a;
    near_relative(solid_volume(&w, dem_box_region(v3(0, 0, 0), v3(2 * a, a, a))), 2.0 * volume, 1e-12, "flush");
    near_relative(solid_volume(&w, dem_box_region(v3(0, 0, 0), v3(a, a, a))), volume, 1e-12, "one of two");
    near_relative(solid_volume(&w, dem_box_region(v3(0.2 * a, 0.5 * a, -a), v3(1.3 * a, 2 * a, 0.1 * a))),
                  1.1 * 0.5 * 0.1 * volume, 1e-12, "a part of both");
    near_relative(solid_volume(&w, dem_cylinder_region(v3(a, 0.5 * a, 0), v3(0, 0, 1), a, 1.2 * a)), 2.0 * volume,
                  1e-12, "in a cylinder");
    near_relative(solid_volume(&w, dem_cylinder_region(v3(a, 0.5 * a, 0.25 * a), v3(0, 0, 1), a, 2 * a)), 1.5 * volume,
                  2e-2, "cut by a cylinder");
    near_relative(solid_volume(&w, dem_sphere_region(v3(a, 0.5 * a, 0.5 * a), 1.3 * a)), 2.0 * volume, 1e-12,
                  "in a sphere");
    assert_true(solid_volume(&w, dem_box_region(v3(0, 0, a), v3(a, a, 2 * a))) < 1e-12 * volume);
    assert_int_equal(dem_add_convex(&w, brick, 1, at + 6, turned, 0, 0), DEM_OK);
    double sum = 0.0;
    for (int k = 0; k < 8; k++) {
        const dem_vec from = v3(k & 1 ? 0.0203 : 0.01, k & 2 ? 0.0195 : 0.01, k & 4 ? 0.0201 : 0.01),
                      to = v3(k & 1 ? 0.03 : 0.0203, k & 2 ? 0.03 : 0.0195, k & 4 ? 0.03 : 0.0201);
        sum += solid_volume(&w, dem_box_region(from, to));
    }
    near_relative(sum, volume, 1e-12, "eight parts");
    near_relative(solid_volume(&w, dem_box_region(v3(0.01, 0.01, 0.01), v3(0.02, 0.03, 0.03))), 0.5 * volume, 1e-12,
                  "a half, however it is turned");
    const double tip_at[3] = {0.05 + 0.25 * a, 0.05 + 0.25 * a, 0.05 + 0.25 * a};
    assert_int_equal(dem_add_convex(&w, tetrahedron, 1, tip_at, NULL, 0, 0), DEM_OK);
    for (double h = 0.05; h < 1.0; h += 0.15)
        near_relative(solid_volume(&w, dem_box_region(v3(0.04, 0.04, 0.05 + h * a), v3(0.06, 0.06, 0.06))),
                      pow(1.0 - h, 3.0) * volume / 6.0, 1e-10, "a tip");
    dem_free(&w);
}

/* One ball and regions that cut it: closed forms, and parts that add up. */
static void test_solid_fraction(void **state) {
    (void)state;
    dem_world w;
    dem_def def = soft_def();
    start(&w, &def);
    add(&w, v3(0.01, 0.02, 0.03), 0.004, 0);
    const double r = 0.002, ball = 4.0 / 3.0 * RIDDLE_PI * r * r * r;
    near_relative(solid_volume(&w, dem_box_region(v3(0, 0, 0), v3(1, 1, 1))), ball, 1e-14, "in a box");
    near_relative(solid_volume(&w, dem_sphere_region(v3(0.01, 0.02, 0.03), 0.01)), ball, 1e-14, "in a sphere");
    near_relative(solid_volume(&w, dem_sphere_region(v3(0.01, 0.02, 0.0305), 0.001)), ball / 8.0, 1e-14,
                  "around a sphere");
    const double d = 0.002, lens = RIDDLE_PI * (2.0 * r - d) * (2.0 * r - d) * (d * d + 4.0 * d * r) / (12.0 * d);
    near_relative(solid_volume(&w, dem_sphere_region(v3(0.01, 0.022, 0.03), r)), lens, 1e-13, "lens");
    for (double c = -0.9; c < 1.0; c += 0.15) { /* across the axis a plane, wide cylinders are a plane beside it too */
        const double cap = RIDDLE_PI / 3.0 * (1.0 - c) * (1.0 - c) * (2.0 + c) * r * r * r;
        near_absolute(solid_volume(&w, dem_cylinder_region(v3(0.01, 0.02, 0.03 + c * r), v3(0, 0, 1), 1.0, 0.1)), cap,
                      1e-4 * ball, "end of a cylinder");
        near_absolute(solid_volume(&w, dem_cylinder_region(v3(0.01 + c * r + 10.0, 0.02, -1), v3(0, 0, 3), 2.0, 10.0)),
                      cap, 2e-4 * ball, "side of a cylinder");
        double sum = 0.0;
        for (int k = 0; k < 10; k++)
            sum += solid_volume(
                &w, dem_cylinder_region(v3(0.0105, 0.0211, 0.0275 + 0.0005 * k), v3(0, 0, 1), 0.0005, 0.0013));
        near_absolute(sum,
                      solid_volume(&w, dem_cylinder_region(v3(0.0105, 0.0211, 0.0275), v3(0, 0, 1), 0.005, 0.0013)),
                      1e-4 * ball, "slices");
    }
    /* a narrow one through the middle: ball with a hole, 4/3 pi (r^3 - (r^2 - a^2)^1.5) */
    near_absolute(solid_volume(&w, dem_cylinder_region(v3(0.01, 0.02, 0.0), v3(0, 0, 1), 1.0, 0.0012)),
                  4.0 / 3.0 * RIDDLE_PI * (8e-9 - 4.096e-9), 1e-4 * ball, "core");
    dem_free(&w);
    def.periodic[0] = def.periodic[1] = def.periodic[2] = 1; /* in eight parts */
    def.high = v3(0.1, 0.1, 0.1);
    start(&w, &def);
    add(&w, v3(0, 0, 0), 0.004, 0);
    near_relative(solid_volume(&w, dem_box_region(v3(0, 0, 0), v3(0.1, 0.1, 0.1))), ball, 1e-13, "across the corner");
    dem_free(&w);
}

/* ---- stress ---- */

/* A column of ten at rest: weight on the floor, and the force through any height is the weight above it. */
static void test_column(void **state) {
    (void)state;
    dem_world w;
    dem_def def = soft_def();
    double weight = 0.0;
    start(&w, &def);
    const int ground = dem_add_plane(&w, 0, v3(0, 0, 0), v3(0, 0, 1));
    for (int k = 0; k < 10; k++) add(&w, v3(0, 0, 2.5e-3 + 5e-3 * k), 5e-3, 0);
    run(&w, 1.0);
    for (int k = 0; k < 10; k++) weight += dem_mass(&w, k) * g;
    near_relative(-w.wall[ground].force.z, weight, 1e-6, "force on the floor");
    const double area = 0.01 * 0.02;
    for (double low = 0.0; low < 0.05; low += 0.0017) {
        for (double high = low + 1e-4; high < 0.06; high += 0.0113) {
            const dem_region slab = dem_box_region(v3(-0.005, -0.01, low), v3(0.005, 0.01, high)),
                             round = dem_cylinder_region(v3(0, 0, low), v3(0, 0, 1), high - low, 0.004);
            dem_measure m, c;
            double above = 0.0;
            assert_int_equal(dem_measure_region(&w, &slab, &m), DEM_OK);
            assert_int_equal(dem_measure_region(&w, &round, &c), DEM_OK);
            for (int k = 0; k < 10; k++)
                above += dem_mass(&w, k) * g * fmin(fmax(dem_position(&w, k).z - low, 0.0), high - low) / (high - low);
            near_absolute(m.contact_stress[2][2] * area, above, 1e-6 * weight, "weight above");
            near_absolute(c.contact_stress[2][2] * RIDDLE_PI * 16e-6, above, 1e-6 * weight, "weight above, cylinder");
            near_absolute(m.contact_stress[0][2] + m.contact_stress[0][0] + m.contact_stress[2][0], 0.0, 1e-9,
                          "other parts");
        }
    }
    /* a chord of 2 mm through it carries the weight of five */
    const dem_region ball = dem_sphere_region(v3(0, 0, 0.0275), 1e-3);
    dem_measure m;
    assert_int_equal(dem_measure_region(&w, &ball, &m), DEM_OK);
    near_relative(m.contact_stress[2][2] * 4.0 / 3.0 * RIDDLE_PI * 1e-9,
                  (dem_mass(&w, 6) * 4.0 * g) * 1e-3 + (dem_mass(&w, 5) * 5.0 * g) * 1e-3, 2e-2, "in a ball");
    dem_free(&w);
}

/* A settled bed, periodic sideways: floor force; integral of the stress is the virial; mean stress rho g h. */
static void test_bed(void **state) {
    (void)state;
    dem_world w;
    dem_def def = soft_def();
    dem_feed feed = dem_default_feed();
    def.periodic[0] = def.periodic[1] = 1;
    def.high = v3(0.03, 0.03, 1);
    start(&w, &def);
    const int ground = dem_add_plane(&w, 0, v3(0, 0, 0), v3(0, 0, 1));
    /* whole spheres within: centres over the whole box */
    feed.region = dem_box_region(v3(-0.0025, -0.0025, 0), v3(0.0325, 0.0325, 0.18));
    feed.sizes = dem_uniform_sizes(4e-3, 6e-3, 0);
    assert_int_equal(dem_fill(&w, &feed, 500), DEM_OK);
    assert_int_equal(feed.missed, 0);
    run(&w, 4.0); /* after a second a grain here and there still rolls to another place */
    double weight = 0.0, virial = 0.0, mass = 0.0;
    for (ptrdiff_t i = 0; i < w.count; i++) {
        weight += dem_mass(&w, i) * g, mass += dem_mass(&w, i);
        virial += dem_mass(&w, i) * g * dem_position(&w, i).z;
    }
    near_relative(-w.wall[ground].force.z, weight, 1e-6, "force on the floor");
    const double area = 9e-4;
    dem_region whole = dem_box_region(v3(0, 0, 0), v3(0.03, 0.03, 0.3));
    dem_measure m;
    assert_int_equal(dem_measure_region(&w, &whole, &m), DEM_OK);
    assert_int_equal(m.count, 500);
    near_relative(m.mass, mass, 1e-12, "mass");
    near_relative(m.contact_stress[2][2] * area * 0.3, virial, 1e-6, "virial");
    near_absolute(m.contact_stress[0][2] / m.contact_stress[2][2], 0.0, 2e-2, "shear");
    /* K of 0.15 .. 0.85. */
    near_relative(m.contact_stress[0][0] + m.contact_stress[1][1], m.contact_stress[2][2], 0.7, "sideways");
    near_relative(solid_volume(&w, dem_box_region(v3(0, 0, -0.01), v3(0.03, 0.03, 0.3))) * 2500.0, mass, 1e-12,
                  "solid volume");
    assert_true(m.coordination > 3.0 && m.coordination < 6.5);

    /* profiles: sharp and smooth, the slabs' stress is the weight above, whatever the kernel */
    for (int k = 0; k < 3; k++) {
        enum { N = 120 };
        static dem_field field[N];
        dem_cells cells = {{0, 0, -0.03}, {0.03, 0.03, 0.21}, {1, 1, N}, {0, 0, 0.004 * k}};
        if (k == 2) cells.width[0] = cells.width[1] = 0.01; /* across the periodic sides */
        double total = 0.0, integral = 0.0, above = 0.0;
        assert_int_equal(dem_coarse_grain(&w, &cells, field), DEM_OK);
        for (int b = N - 1; b >= 0; b--) {
            const double h = 0.002;
            total += field[b].density * area * h;
            integral += field[b].contact_stress[2][2] * area * h;
            if (k > 0 && b < N - 1) { /* balance of momentum, from slab to slab; the density changes smoothly */
                above += 0.5 * (field[b].density + field[b + 1].density) * g * h;
                if (b > 30) near_absolute(field[b].contact_stress[2][2], above, 3e-3 * weight / area, "rho g h");
            }
        }
        near_relative(total, mass, 1e-12, "mass of a profile");
        near_relative(integral, virial, 1e-5, "virial of a profile");
    }
    dem_free(&w);
}

/* ---- velocities ---- */

static void test_kinetic(void **state) {
    (void)state;
    dem_world w;
    dem_def def = soft_def();
    dem_feed feed = dem_default_feed();
    def.gravity = v3(0, 0, 0);
    start(&w, &def);
    feed.region = dem_sphere_region(v3(0.05, 0.05, 0.05), 0.05);
    feed.sizes = dem_uniform_sizes(2e-3, 8e-3, 0);
    feed.velocity = v3(1, -2, 3);
    feed.scatter = v3(0.1, 0.2, 0.3);
    assert_int_equal(dem_fill(&w, &feed, 300), DEM_OK);
    const dem_region region = dem_cylinder_region(v3(0.05, 0.05, 0.02), v3(0, 0, 1), 0.06, 0.04);
    const double volume = dem_region_volume(&region);
    dem_measure m;
    dem_field field = {0};
    double mass = 0.0, mean[3] = {0, 0, 0}, stress[3][3] = {{0.0}};
    int count = 0;
    assert_int_equal(dem_measure_region(&w, &region, &m), DEM_OK);
    for (int pass = 0; pass < 2; pass++) {
        for (ptrdiff_t i = 0; i < w.count; i++) {
            if (!dem_region_holds(&region, dem_position(&w, i))) continue;
            const dem_vec v = dem_velocity(&w, i);
            if (pass == 0) count++, mass += dem_mass(&w, i);
            for (int a = 0; a < 3; a++) {
                if (pass == 0) mean[a] += dem_mass(&w, i) * dem_axis(v, a);
                for (int b = 0; pass == 1 && b < 3; b++)
                    stress[a][b] += dem_mass(&w, i) * (dem_axis(v, a) - mean[a] / mass) *
                                    (dem_axis(v, b) - mean[b] / mass) / volume;
            }
        }
    }
    assert_true(count == m.count && count > 50 && count < 300);
    near_relative(m.mass, mass, 1e-13, "mass");
    for (int a = 0; a < 3; a++) {
        near_relative(dem_axis(m.velocity, a), mean[a] / mass, 1e-13, "velocity");
        for (int b = 0; b < 3; b++)
            near_absolute(m.kinetic_stress[a][b], stress[a][b], 1e-12 * stress[2][2], "kinetic stress");
    }
    near_relative(m.granular_temperature * 3.0 * mass / volume, stress[0][0] + stress[1][1] + stress[2][2], 1e-12,
                  "temperature");
    near_absolute(m.granular_temperature, (0.01 + 0.04 + 0.09) / 9.0, 0.004, "temperature of the scatter");

    /* one cell around all of it tells the same of the whole; many cells keep mass and momentum */
    dem_cells cells = {{-0.02, -0.02, -0.02}, {0.12, 0.12, 0.12}, {1, 1, 1}, {0.0, 0.01, 0.0}};
    assert_int_equal(dem_coarse_grain(&w, &cells, &field), DEM_OK);
    const dem_region all = dem_box_region(cells.low, cells.high);
    assert_int_equal(dem_measure_region(&w, &all, &m), DEM_OK);
    const double box = dem_region_volume(&all);
    near_relative(field.density * box, m.mass, 1e-13, "density");
    near_relative(field.momentum.y / field.density, m.velocity.y, 1e-13, "velocity");
    near_relative(field.kinetic_stress[2][2], m.kinetic_stress[2][2], 1e-10, "kinetic stress");
    static dem_field many[9 * 7 * 5];
    for (int k = 0; k < 4; k++) {
        const dem_cells block = {
            {-0.02, -0.02, -0.02}, {0.12, 0.12, 0.12}, {9, 7, 5}, {k * 0.006, k == 2 ? 0.0 : 0.013, k * 0.001}};
        double total = 0.0, momentum = 0.0;
        assert_int_equal(dem_coarse_grain(&w, &block, many), DEM_OK);
        for (int c = 0; c < 9 * 7 * 5; c++) total += many[c].density, momentum += many[c].momentum.x;
        near_relative(total * box / 315.0, m.mass, 1e-13, "mass in cells");
        near_relative(momentum * box / 315.0, dem_momentum(&w).x, 1e-13, "momentum in cells");
    }
    dem_free(&w);
}

/* ---- contacts ---- */

/* Bricks whose long axes point where they are told: the tensor, its parameter and its direction, in a part of space,
   too; clumps alike. */
static void test_order(void **state) {
    (void)state;
    enum { N = 400 };
    dem_world w;
    dem_def def = soft_def();
    dem_convex shape;
    dem_order order;
    double centre[N][3], turn[N][4];
    uint64_t random = 3;
    start(&w, &def);
    add(&w, v3(0, 0, -1), 5e-3, 0); /* a sphere lies nowhere */
    assert_int_equal(dem_measure_order(&w, NULL, 2, &order), DEM_OK);
    assert_true(order.bodies == 0 && isnan(order.parameter));
    assert_int_equal(dem_make_brick(&shape, v3(1e-3, 2e-3, 4e-3), 0.05, NULL), DEM_OK);
    const int number = dem_add_shape(&w, &shape);
    for (int k = 0; k < N; k++) {
        centre[k][0] = 0.01 * (k % 20), centre[k][1] = 0.01 * (k / 20), centre[k][2] = 0.0;
        /* half along z, half along y */
        turn[k][0] = 1.0, turn[k][1] = k < N / 2 ? 0.0 : 1.0, turn[k][2] = turn[k][3] = 0.0;
    }
    assert_int_equal(dem_add_convex(&w, number, N, &centre[0][0], &turn[0][0], 0, 0), DEM_OK);
    assert_int_equal(dem_measure_order(&w, NULL, 2, &order), DEM_OK);
    assert_int_equal(order.bodies, N);
    near_absolute(order.tensor[0][0], -0.5, 1e-12, "across"), near_absolute(order.tensor[2][2], 0.25, 1e-12, "along");
    near_absolute(order.parameter, 0.25, 1e-12, "parameter");
    const dem_region half = dem_box_region(v3(-1, -1, -1), v3(1, 0.095, 1));
    assert_int_equal(dem_measure_order(&w, &half, 2, &order), DEM_OK);
    assert_int_equal(order.bodies, N / 2);
    near_absolute(order.parameter, 1.0, 1e-12, "parallel"),
        near_absolute(fabs(order.director.z), 1.0, 1e-12, "director");
    assert_int_equal(dem_measure_order(&w, &half, 0, &order), DEM_OK);
    near_absolute(fabs(order.director.x), 1.0, 1e-12, "director of x");
    for (ptrdiff_t i = 1; i < w.count; i++) {
        const dem_quaternion q = {dem__uniform(&random) - 0.5, dem__uniform(&random) - 0.5, dem__uniform(&random) - 0.5,
                                  dem__uniform(&random) - 0.5};
        assert_int_equal(dem_set_orientation(&w, i, q), DEM_OK);
    }
    assert_int_equal(dem_measure_order(&w, NULL, 2, &order), DEM_OK);
    assert_true(order.parameter > 0.0 && order.parameter < 0.2);
    near_absolute(order.tensor[0][0] + order.tensor[1][1] + order.tensor[2][2], 0.0, 1e-12, "trace");
    const double three[9] = {0, 0, 0, 0, 2e-3, 0, 0, 4e-3, 0}, diameter[3] = {3e-3, 3e-3, 3e-3}, at[3] = {0, 0, 0.5},
                 up[4] = {1, 1, 0, 0};
    dem_clump clump;
    assert_int_equal(dem_make_clump(3, three, diameter, &clump), DEM_OK);
    assert_int_equal(dem_add_clumps(&w, 1, &clump, at, NULL, up, 0, 0), DEM_OK);
    const dem_region above = dem_box_region(v3(-1, -1, 0.4), v3(1, 1, 0.6));
    assert_int_equal(dem_measure_order(&w, &above, 1, &order), DEM_OK);
    assert_int_equal(order.bodies, 1);
    near_absolute(fabs(order.director.z), 1.0, 1e-12, "clump");
    assert_int_equal(dem_measure_order(&w, NULL, 3, &order), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_measure_order(NULL, NULL, 0, &order), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_measure_order(&w, NULL, 0, NULL), DEM_BAD_ARGUMENT);
    dem_free(&w);
}

/* A sphere that slides has the tangential force that Coulomb's law gives. */
static void test_histogram_of_tangential_forces(void **state) {
    (void)state;
    dem_world w;
    dem_def def = soft_def();
    double count[2];
    def.gravity = v3(0, 0, 0);
    start(&w, &def);
    dem_add_plane(&w, 0, v3(0, 0, -0.0024), v3(0, 0, 1));
    add(&w, v3(0, 0, 0), 5e-3, 0);
    assert_int_equal(dem_set_motion(&w, 0, v3(0.6, 0.8, 0.0), v3(0, 0, 0)), DEM_OK);
    dem_run(&w, 0.0, DEM_LINEAR | DEM_FRICTION);
    dem_run(&w, 5.0 * def.dt, DEM_LINEAR | DEM_FRICTION);
    const dem_contact_info c = dem_get_contact(&w, 0);
    const double limit = 0.5 * c.force.z;
    assert_true(limit > 0.0);
    assert_int_equal(dem_histogram(&w, DEM_CONTACT_TANGENTIAL_FORCE, 0.99 * limit, 1.01 * limit, 2, count), 0);
    assert_true(count[0] + count[1] == 1.0);
    assert_int_equal(dem_histogram(&w, DEM_CONTACT_TANGENTIAL_FORCE, 1.1 * limit, 2.0 * limit, 2, count), 1);
    dem_free(&w);
}

static void test_histogram_and_unlike_contacts(void **state) {
    (void)state;
    dem_world w;
    dem_def def = soft_def();
    double count[4] = {0}, overlap[10];
    def.gravity = v3(0, 0, 0);
    start(&w, &def);
    dem_add_plane(&w, 0, v3(0, 0, -0.0024), v3(0, 0, 1)); /* each touches it by 1e-4 */
    const double x[5] = {0.0, 0.0049, 0.0097, 0.0144, 0.03};
    for (int k = 0; k < 5; k++) add(&w, v3(x[k], 0, 0), 5e-3, k < 2);
    run(&w, 0.0);
    assert_int_equal(dem_contact_count(&w), 8);
    assert_int_equal(dem_histogram(&w, DEM_CONTACT_OVERLAP, 0.0, 2.5e-4, 10, overlap), 1); /* of 3e-4 */
    assert_true(overlap[3] + overlap[4] == 6.0 && overlap[7] + overlap[8] == 1.0);
    assert_int_equal(dem_histogram(&w, DEM_CONTACT_FORCE, 0.5, 4.5, 4, count), 0);
    assert_true(count[0] == 6.0 && count[1] == 1.0 && count[2] == 1.0 && count[3] == 0.0);
    /* Ends: 1 1 | 1 0 | 0 0. */
    near_relative(dem_unlike_contacts(&w, 1), (1.0 / 3.0) / (2.0 * 0.5 * 0.5), 1e-12, "unlike contacts");
    assert_true(isnan(dem_unlike_contacts(&w, 7)) && isnan(dem_unlike_contacts(NULL, 1)));
    assert_int_equal(dem_histogram(&w, DEM_CONTACT_FORCE, 1.0, 1.0, 4, count), -(int)DEM_BAD_ARGUMENT);
    assert_int_equal(dem_histogram(&w, DEM_CONTACT_FORCE, nan_, 1.0, 4, count), -(int)DEM_BAD_ARGUMENT);
    assert_int_equal(dem_histogram(&w, DEM_CONTACT_FORCE, 0.0, inf, 4, count), -(int)DEM_BAD_ARGUMENT);
    assert_int_equal(dem_histogram(&w, DEM_CONTACT_FORCE, 0.0, 1.0, 0, count), -(int)DEM_BAD_ARGUMENT);
    assert_int_equal(dem_histogram(&w, (dem_quantity)5, 0.0, 1.0, 4, count), -(int)DEM_BAD_ARGUMENT);
    assert_int_equal(dem_histogram(NULL, DEM_CONTACT_FORCE, 0.0, 1.0, 4, count), -(int)DEM_BAD_ARGUMENT);
    dem_free(&w);
}

/* ---- residence ---- */

static void test_residence(void **state) {
    (void)state;
    dem_world w;
    dem_def def = soft_def();
    double entered[4] = {nan_, nan_, nan_, nan_}, stayed[4] = {0, 0, 0, 0};
    def.gravity = v3(0, 0, 0);
    start(&w, &def);
    dem_add_exit(&w, v3(0, 0, 0.0), v3(0, 0, 1));
    for (int k = 0; k < 5; k++) {
        add(&w, v3(0.02 * k, 0, 0.1), 5e-3, 0);
        dem_set_motion(&w, k, v3(0, 0, k == 3 ? 0.1 : -0.1 * (k + 1)), v3(0, 0, 0)); /* one stays above */
    }
    const dem_region region = dem_box_region(v3(-1, -1, -1), v3(1, 1, 0.05)),
                     window = dem_box_region(v3(-1, -1, 0.03), v3(1, 1, 0.06));
    double in_window[4] = {0, 0, 0, 0}, at[4] = {nan_, nan_, nan_, nan_};
    for (int k = 0; k < 1200; k++) {
        assert_int_equal(dem_residence(&w, &region, 4, entered, stayed), DEM_OK);
        assert_int_equal(dem_residence(&w, &window, 4, at, in_window), DEM_OK);
        run(&w, 0.001);
    }
    for (int k = 0; k < 3; k++) { /* 0.05 m to the exit */
        near_absolute(stayed[k], 0.05 / (0.1 * (k + 1)), 0.0011, "time in the region");
        near_absolute(in_window[k], 0.03 / (0.1 * (k + 1)), 0.0021, "time in the window");
        assert_true(isnan(entered[k]));
    }
    assert_true(stayed[3] == 0.0 && isnan(entered[3]));
    assert_int_equal(dem_residence(&w, &region, 1, NULL, stayed), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_residence(&w, NULL, 1, entered, stayed), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_residence(&w, &region, -1, entered, stayed), DEM_BAD_ARGUMENT);
    dem_free(&w);
}

/* ---- mixing ---- */

static void test_mixing(void **state) {
    (void)state;
    enum { SAMPLES = 60, SHUFFLES = 400 };
    scene_random r = {21};
    double of_group[SAMPLES], of_all[SAMPLES], mean = 0.0, square = 0.0;
    int total = 0;
    for (int k = 0; k < SAMPLES; k++) of_all[k] = k % 7 == 3 ? 0.0 : 5.0 + k % 13, total += (int)of_all[k];
    const int ones = total / 3;
    for (int s = 0; s < SHUFFLES; s++) { /* cards dealt at random: on average the index is 1 */
        int left = total, ones_left = ones;
        for (int k = 0; k < SAMPLES; k++) {
            of_group[k] = 0.0;
            for (int c = 0; c < (int)of_all[k]; c++, left--) {
                const int one = scene_uniform(&r) * left < ones_left;
                of_group[k] += one, ones_left -= one;
            }
        }
        const dem_mixing m = dem_mixing_of(SAMPLES, of_group, of_all);
        mean += m.lacey / SHUFFLES, square += m.lacey * m.lacey / SHUFFLES;
        near_relative(m.share, (double)ones / total, 1e-14, "share");
    }
    near_absolute(mean, 1.0, 4.0 * sqrt((square - mean * mean) / SHUFFLES), "Lacey's index of random mixtures");
    assert_true(square - mean * mean < 1e-3);
    for (int k = 0; k < SAMPLES; k++) of_group[k] = k < 20 ? of_all[k] : 0.0;
    dem_mixing m = dem_mixing_of(SAMPLES, of_group, of_all);
    near_absolute(m.lacey, 0.0, 1e-14, "separated");
    near_relative(m.segregation, 1.0, 1e-14, "separated");
    for (int k = 0; k < SAMPLES; k++) of_all[k] = 10.0, of_group[k] = 3.0; /* more even than random */
    m = dem_mixing_of(SAMPLES, of_group, of_all);
    near_absolute(m.segregation, 0.0, 1e-14, "perfect");
    near_relative(m.lacey, 1.0 / (1.0 - 59.0 / 599.0), 1e-12, "perfect");
    near_relative(m.separated, 0.21, 1e-13, "separated variance");
    of_group[3] = 11.0;
    assert_true(isnan(dem_mixing_of(SAMPLES, of_group, of_all).lacey));
    of_group[3] = nan_;
    assert_true(isnan(dem_mixing_of(SAMPLES, of_group, of_all).lacey));
    for (int k = 0; k < SAMPLES; k++) of_group[k] = 0.0;
    assert_true(isnan(dem_mixing_of(SAMPLES, of_group, of_all).lacey) &&
                isnan(dem_mixing_of(0, of_group, of_all).lacey));
    assert_true(isnan(dem_mixing_of(SAMPLES, NULL, of_all).lacey));

    dem_world w;
    dem_def def = soft_def();
    start(&w, &def);
    for (int k = 0; k < 8; k++) add(&w, v3(0.01 * (k % 4) + 0.005, 0.005, k < 4 ? 0.005 : 0.095), 1e-3, k % 2);
    const dem_cells cells = {{0, 0, 0}, {0.04, 0.01, 0.05}, {2, 1, 1}, {1, 1, 1}};
    double a[2], b[2];
    assert_int_equal(dem_count_in_cells(&w, &cells, 1, a, b), DEM_OK);
    assert_true(a[0] == 1.0 && a[1] == 1.0 && b[0] == 2.0 && b[1] == 2.0);
    dem_free(&w);
}

/* ---- hostile input ---- */

static void test_bad_input(void **state) {
    (void)state;
    dem_world w, empty;
    dem_def def = soft_def();
    dem_measure m;
    dem_field field[8];
    double a[8], b[8];
    memset(&empty, 0, sizeof empty);
    start(&w, &def);
    const dem_region box = dem_box_region(v3(0, 0, 0), v3(1, 1, 1)), bad = dem_box_region(v3(0, 0, nan_), v3(1, 1, 1)),
                     flat = dem_box_region(v3(0, 0, 0), v3(1, 1, 0));
    assert_int_equal(dem_measure_region(&w, &box, &m), DEM_OK);
    assert_true(m.count == 0 && m.mass == 0.0 && m.solid_fraction == 0.0 && m.granular_temperature == 0.0);
    assert_int_equal(dem_measure_region(NULL, &box, &m), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_measure_region(&empty, &box, &m), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_measure_region(&w, &bad, &m), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_measure_region(&w, NULL, &m), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_measure_region(&w, &box, NULL), DEM_BAD_ARGUMENT);
    add(&w, v3(0.5, 0.5, 0.0), 0.01, 0);
    assert_int_equal(dem_measure_region(&w, &flat, &m), DEM_OK);
    assert_true(m.count == 1 && isnan(m.solid_fraction));
    for (int k = 0; k < 8; k++) {
        dem_cells c = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {0, 0, 0}};
        if (k == 0) c.n[1] = 0;
        if (k == 1) c.n[0] = 100001;
        if (k == 2) c.n[0] = c.n[1] = c.n[2] = 100000;
        if (k == 3) c.width[2] = nan_;
        if (k == 4) c.width[1] = -1.0;
        if (k == 5) c.high.z = 0.0;
        if (k == 6) c.low.x = -inf;
        const dem_status wanted = k < 7 ? DEM_BAD_ARGUMENT : DEM_OK;
        assert_int_equal(dem_coarse_grain(&w, &c, field), wanted);
        assert_int_equal(dem_count_in_cells(&w, &c, 0, a, b), wanted);
    }
    const dem_cells wide = {{-1.7e308, -1, -1}, {1.7e308, 1, 1}, {3, 1, 1}, {0, 0, 0}}; /* a length that is no number */
    add(&w, v3(1e149, 0, 0), 0.01, 0);
    dem_count_in_cells(&w, &wide, 0, a, b);
    const dem_cells c = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {0, 0, 0}};
    assert_int_equal(dem_coarse_grain(&w, NULL, field), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_coarse_grain(&w, &c, NULL), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_coarse_grain(NULL, &c, field), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_count_in_cells(&w, &c, 0, NULL, b), DEM_BAD_ARGUMENT);
    dem_free(&w);
}

/* Spheres on the edges and in the corners of a periodic box count once, like those inside, wherever the box lies. */
static void test_periodic_edges(void **state) {
    (void)state;
    for (int k = 0; k < 8; k++) {
        const double pitch = 0.0078125, corner = k < 4 ? 0.0 : -4.0 * pitch, shift = k % 2 ? 0.5 * pitch : 0.0;
        dem_def def = soft_def();
        dem_world w;
        dem_measure m;
        dem_field field[16];
        def.gravity = v3(0, 0, 0);
        for (int a = 0; a < 3; a++) def.periodic[a] = k % 4 < 2 || a < 2;
        def.low = v3(corner, corner, corner), def.high = v3(corner + 8 * pitch, corner + 8 * pitch, corner + 8 * pitch);
        start(&w, &def);
        for (int i = 0; i < 512; i++)
            add(&w,
                v3(corner + shift + i % 8 * pitch, corner + shift + i / 8 % 8 * pitch, corner + shift + i / 64 * pitch),
                5e-3, 0);
        const dem_region box = dem_box_region(def.low, def.high);
        const dem_cells cells = {def.low, def.high, {4, 2, 2}, {0.0, 0.0, 0.0}};
        const double volume = pow(8.0 * pitch, 3.0), mass = dem_mass(&w, 0);
        assert_int_equal(dem_measure_region(&w, &box, &m), DEM_OK);
        assert_int_equal(m.count, 512);
        near_relative(m.mass, 512.0 * mass, 1e-13, "mass in the box");
        assert_int_equal(dem_coarse_grain(&w, &cells, field), DEM_OK);
        for (int c = 0; c < 16; c++)
            near_relative(field[c].density * volume / 16.0, 32.0 * mass, 1e-13, "mass of a cell");
        dem_free(&w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ball_in_box),
        cmocka_unit_test(test_solid_fraction),
        cmocka_unit_test(test_solid_polyhedra),
        cmocka_unit_test(test_column),
        cmocka_unit_test(test_bed),
        cmocka_unit_test(test_kinetic),
        cmocka_unit_test(test_histogram_of_tangential_forces),
        cmocka_unit_test(test_histogram_and_unlike_contacts),
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_periodic_edges),
        cmocka_unit_test(test_residence),
        cmocka_unit_test(test_mixing),
        cmocka_unit_test(test_bad_input),
    };
    return cmocka_run_group_tests_name("dem_measure", tests, NULL, NULL);
}
