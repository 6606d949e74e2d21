/* filtration.h, the resolved fluid: flows with closed solutions, drag of periodic arrays, a moving sphere in two
   frames, the same bits for any number of threads and after loading, settling, what is refused, divergence with its
   place, failing memory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "failing_allocator.h"
#include "filtration.h"

static filtration_fluid_def small_box(int n) {
    filtration_fluid_def def = filtration_fluid_default_def();
    def.nodes[0] = def.nodes[1] = def.nodes[2] = n;
    def.voxel = 1e-6;
    return def;
}

/* ---- between plates ---- */

/* Largest error of the velocity along `flow` between two walls, over the largest velocity. */
static double plate_error(int axis, int lattice, double tau, int couette) {
    const int n = 11, flow = (axis + 1) % 3;
    filtration_fluid_def def = small_box(4);
    def.nodes[axis] = n;
    def.tau = tau;
    def.lattice = (filtration_lattice)lattice;
    def.face[2 * axis] = def.face[2 * axis + 1] = FILTRATION_WALL;
    if (couette) def.face_velocity[2 * axis + 1][flow] = 0.01;
    else def.body_force[flow] = 1e3;
    filtration_fluid fluid;
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    assert_int_equal(filtration_fluid_run(&fluid, (int64_t)(2000 / (tau - 0.5)) + 200, NULL), FILTRATION_OK);
    double worst = 0.0, largest = 0.0;
    for (int k = 0; k < n; k++) {
        int p[3] = {2, 2, 2};
        filtration_sample s;
        p[axis] = k;
        assert_int_equal(filtration_fluid_at(&fluid, p[0], p[1], p[2], &s), FILTRATION_OK);
        const double y = (k + 0.5) * def.voxel, height = n * def.voxel;
        const double exact = couette ? 0.01 * y / height : 1e3 / (2.0 * def.viscosity) * y * (height - y);
        worst = fmax(worst, fabs(s.velocity[flow] - exact));
        largest = fmax(largest, exact);
    }
    filtration_fluid_free(&fluid);
    return worst / largest;
}

static void test_plates(void **state) {
    (void)state;
    for (int axis = 0; axis < 3; axis++)
        for (int lattice = 0; lattice < 2; lattice++)
            for (int couette = 0; couette < 2; couette++) {
                assert_true(plate_error(axis, lattice, 0.8, couette) < 1e-12);
                assert_true(plate_error(axis, lattice, 3.5, couette) < 1e-12);
            }
}

/* Pressure faces and walls: a channel; mirrors: half of it. Flux over that of the pressure gradient in the middle: the
   ends are open, so that the flow enters over less length than the channel has. */
static double channel_flux(int mirror) {
    filtration_fluid_def def = small_box(4);
    def.nodes[0] = mirror ? 5 : 10;
    def.nodes[2] = 40;
    def.face[FILTRATION_LOW_X] = FILTRATION_WALL;
    def.face[FILTRATION_HIGH_X] = mirror ? FILTRATION_SYMMETRY : FILTRATION_WALL;
    def.face[FILTRATION_LOW_Z] = def.face[FILTRATION_HIGH_Z] = FILTRATION_PRESSURE;
    def.face_pressure[FILTRATION_LOW_Z] = 0.04;
    filtration_fluid fluid;
    filtration_sample low, high;
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    assert_int_equal(filtration_fluid_run(&fluid, 8000, NULL), FILTRATION_OK);
    const double in = filtration_fluid_flux(&fluid, 2, 0), out = filtration_fluid_flux(&fluid, 2, 39);
    assert_true(fabs(in - out) < 1e-6 * in);
    assert_int_equal(filtration_fluid_at(&fluid, 4, 1, 15, &low), FILTRATION_OK);
    assert_int_equal(filtration_fluid_at(&fluid, 4, 1, 25, &high), FILTRATION_OK);
    filtration_fluid_free(&fluid);
    const double gradient = (low.pressure - high.pressure) / 10e-6;
    assert_true(fabs(gradient * 40e-6 / 0.04 - 1.0) < 0.06);
    return in / (gradient * 1e-10 / (12.0 * 1e-3));
}

static void test_pressure_and_mirror(void **state) {
    (void)state;
    const double whole = channel_flux(0), half = channel_flux(1);
    assert_true(fabs(whole - 1.0) < 0.01);
    assert_true(fabs(half / whole - 1.0) < 1e-9);
}

/* ---- the level of the pressure ---- */

static void level_flow(void *user, const double point[3], double velocity[3], double *pressure) {
    (void)point;
    velocity[0] = velocity[1] = velocity[2] = 0.0, *pressure = *(const double *)user;
}

/* Three spheres in a liquid at rest at p0: two with a gap [voxels], the third at one of them or cut by a face. Largest
   force over p0 pi R^2, torque over p0 pi R^3. */
static double level_force(double p0, double gap, filtration_face side, int cut) {
    const double voxel = 7.5e-6, R = 40e-6, z = 16 * voxel, h = R + 0.5 * gap * voxel,
                 x = (side == FILTRATION_SYMMETRY ? 0.0 : 10.5) * voxel;
    filtration_fluid_def def = filtration_fluid_default_def();
    filtration_fluid fluid;
    def.voxel = voxel, def.tau = 0.6, def.bulk_ratio = 10.0;
    def.nodes[0] = def.nodes[1] = 21, def.nodes[2] = 32;
    def.face[0] = def.face[1] = side;
    def.face[4] = def.face[5] = FILTRATION_PRESSURE, def.face_pressure[4] = def.face_pressure[5] = p0;
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    assert_int_equal(filtration_fluid_set_flow(&fluid, level_flow, &p0), FILTRATION_OK);
    double centre[9] = {
        x, 10.5 * voxel, z - h, x, 10.5 * voxel, z + h, x + 2.0 * h, 10.1 * voxel, cut ? 2.3 * voxel : z - h};
    double zero[9] = {0}, radius[3] = {R, R, R}, force[9], torque[9], worst = 0.0;
    const filtration_spheres s = {3, centre, zero, zero, radius, force, torque};
    assert_int_equal(filtration_fluid_run(&fluid, 6, &s), FILTRATION_OK);
    for (int k = 0; k < 9; k++)
        worst = fmax(worst, fmax(fabs(force[k]), fabs(torque[k]) / R) / (fabs(p0) * 3.14159265358979 * R * R));
    filtration_fluid_free(&fluid);
    return worst;
}

/* Spheres on two wires, one of them cut by a face, in a flow between faces at low and low + 100 Pa: forces and places
   after a while. */
static void level_of_cake(double low, int moves, double out[36]) {
    enum { N = 6 };
    const double voxel = 10e-6, R = 40e-6;
    double start = low + 50.0;
    static const double box[3] = {160e-6, 160e-6, 300e-6}, a[6] = {0, 50e-6, 60e-6, 0, 130e-6, 60e-6},
                        b[6] = {160e-6, 50e-6, 60e-6, 160e-6, 130e-6, 60e-6}, wire[2] = {20e-6, 20e-6};
    static const int periodic[3] = {1, 1, 0};
    filtration_bed bed;
    filtration_fluid_def def = filtration_fluid_default_def();
    filtration_motion_def motion = filtration_motion_default_def();
    filtration_fluid fluid;
    assert_int_equal(filtration_bed_init(&bed, 2, a, b, wire, box, periodic, 40e-6, NULL), FILTRATION_OK);
    def.voxel = voxel, def.tau = 0.6, def.bulk_ratio = 10.0;
    def.nodes[0] = def.nodes[1] = 16, def.nodes[2] = 30;
    def.face[4] = def.face[5] = FILTRATION_PRESSURE, def.face_pressure[4] = low, def.face_pressure[5] = low + 100.0;
    def.solid = filtration_bed_solid(&bed);
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    assert_int_equal(filtration_fluid_set_flow(&fluid, level_flow, &start), FILTRATION_OK);
    double centre[3 * N] = {40e-6,  90e-6, 108e-6, 120e-6, 90e-6, 108e-6, 40e-6, 10e-6, 107e-6,
                            120e-6, 10e-6, 110e-6, 80e-6,  80e-6, 178e-6, 20e-6, 20e-6, 281e-6};
    double velocity[3 * N] = {0}, spin[3 * N] = {0}, radius[N] = {R, R, R, R, R, 25e-6}, force[3 * N], torque[3 * N];
    const filtration_spheres s = {N, centre, velocity, spin, radius, force, torque};
    filtration_spheres moved = s;
    for (int k = 0; k < 400; k++) {
        assert_int_equal(filtration_fluid_step(&fluid, &s), FILTRATION_OK);
        if (moves) assert_int_equal(filtration_move(&motion, &fluid, &moved, 1.0, NULL), FILTRATION_OK);
    }
    for (int k = 0; k < 3 * N; k++)
        out[k] = moves ? centre[k] : force[k], out[18 + k] = moves ? velocity[k] : torque[k] / R;
    filtration_fluid_free(&fluid);
    filtration_bed_free(&bed);
}

static void test_pressure_has_no_level(void **state) {
    (void)state;
    static const double gaps[] = {-0.1, 0.0, 0.1, 0.7, 3.0}, levels[] = {500.0, -500.0, 5e4};
    for (int g = 0; g < 5; g++)
        for (int p = 0; p < 3; p++) assert_true(level_force(levels[p], gaps[g], FILTRATION_PERIODIC, 0) < 1e-10);
    for (int p = 0; p < 3; p++) {
        assert_true(level_force(levels[p], 0.1, FILTRATION_WALL, 1) < 1e-10);
        assert_true(level_force(levels[p], 0.1, FILTRATION_SYMMETRY, 1) < 1e-10);
    }
    double about[36], above[36];
    for (int moves = 0; moves < 2; moves++) {
        double largest[2] = {0, 0};
        level_of_cake(-50.0, moves, about);
        level_of_cake(0.0, moves, above);
        for (int k = 0; k < 36; k++) largest[k / 18] = fmax(largest[k / 18], fabs(about[k]));
        for (int k = 0; k < 36; k++) assert_true(fabs(about[k] - above[k]) < 1e-9 * largest[k / 18]);
    }
}

/* What a liquid is driven by in a periodic box, touching spheres take up: films push both with equal forces. */
static void test_films_keep_momentum(void **state) {
    (void)state;
    filtration_fluid_def def = small_box(20);
    filtration_fluid fluid;
    def.tau = 2.0;
    def.body_force[0] = 1e3, def.body_force[2] = 2e3;
    double centre[9] = {6.2e-6, 6.1e-6, 6.3e-6, 14.2e-6, 6.1e-6, 6.3e-6, 10.2e-6, 12.4e-6, 9.0e-6}, zero[9] = {0};
    double radius[3] = {4e-6, 4e-6, 3.9e-6}, force[9], torque[9];
    const filtration_spheres s = {3, centre, zero, zero, radius, force, torque};
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    assert_int_equal(filtration_fluid_run(&fluid, 1500, &s), FILTRATION_OK);
    const double liquid = filtration_fluid_porosity(&fluid) * 8000e-18;
    for (int a = 0; a < 3; a += 2)
        assert_true(fabs((force[a] + force[3 + a] + force[6 + a]) / (def.body_force[a] * liquid) - 1.0) < 1e-6);
    filtration_fluid_free(&fluid);
}

/* ---- Taylor-Green ---- */

typedef struct vortex {
    double k, speed, density;
} vortex;

static void vortex_flow(void *user, const double x[3], double u[3], double *p) {
    const vortex *v = (const vortex *)user;
    u[0] = v->speed * sin(v->k * x[0]) * cos(v->k * x[1]);
    u[1] = -v->speed * cos(v->k * x[0]) * sin(v->k * x[1]);
    u[2] = 0.0;
    *p = 0.25 * v->density * v->speed * v->speed * (cos(2 * v->k * x[0]) + cos(2 * v->k * x[1]));
}

/* Error of the velocity after a fixed time, over the velocity, on n nodes a side. */
static double vortex_error(int n, int precision) {
    filtration_fluid_def def = small_box(n);
    def.nodes[2] = 1;
    def.voxel = 1e-3 / n;
    def.tau = 0.8;
    def.precision = (filtration_precision)precision;
    filtration_fluid fluid;
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    vortex v = {2.0 * 3.14159265358979323846 / 1e-3, 0.16 / n * def.voxel / fluid.dt, def.density};
    assert_int_equal(filtration_fluid_set_flow(&fluid, vortex_flow, &v), FILTRATION_OK);
    assert_int_equal(filtration_fluid_run(&fluid, n * n / 4, NULL), FILTRATION_OK);
    const double decay = exp(-2.0 * 1e-6 * v.k * v.k * fluid.time);
    double worst = 0.0;
    for (int y = 0; y < n; y++)
        for (int x = 0; x < n; x++) {
            filtration_sample s;
            const double point[3] = {(x + 0.5) * def.voxel, (y + 0.5) * def.voxel, 0.0};
            double u[3], p;
            filtration_fluid_at(&fluid, x, y, 0, &s);
            vortex_flow(&v, point, u, &p);
            worst = fmax(worst, fmax(fabs(s.velocity[0] - decay * u[0]), fabs(s.velocity[1] - decay * u[1])));
        }
    filtration_fluid_free(&fluid);
    return worst / (v.speed * decay);
}

static void test_vortex_is_second_order(void **state) {
    (void)state;
    const double coarse = vortex_error(16, FILTRATION_DOUBLE), fine = vortex_error(32, FILTRATION_DOUBLE);
    assert_true(fine < 0.01);
    assert_in_range((int)(100.0 * coarse / fine), 310, 480);
    assert_true(fabs(vortex_error(32, FILTRATION_FLOAT) - fine) < 1e-4);
}

/* ---- periodic arrays ---- */

/* Drag factor K of a simple cubic array of solid volume fraction c on n nodes a side, the sphere's centre shifted by
   part of a voxel. */
static double array_drag(double c, int n, double tau, int lattice, int precision, int boundary, const double shift[3]) {
    filtration_fluid_def def = small_box(n);
    def.tau = tau;
    def.lattice = (filtration_lattice)lattice;
    def.precision = (filtration_precision)precision;
    def.boundary = (filtration_boundary)boundary;
    const double side = n * def.voxel, radius = cbrt(3.0 * c / (4.0 * 3.14159265358979323846)) * side;
    double centre[3], zero[3] = {0, 0, 0}, force[3], torque[3], r = radius;
    for (int a = 0; a < 3; a++) centre[a] = 0.5 * side + shift[a] * def.voxel;
    filtration_spheres spheres = {1, centre, zero, zero, &r, force, torque};
    filtration_fluid fluid;
    filtration_permeability_result result;
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    assert_int_equal(filtration_fluid_permeability(&fluid, &spheres, 2, 100.0 * side, 1e-6, 100000, &result),
                     FILTRATION_OK);
    const double pushed = 100.0 * side * side * side * result.porosity;
    assert_true(fabs(force[2] - pushed) < 2e-4 * pushed);
    filtration_fluid_free(&fluid);
    return 100.0 * side * side * side / (6.0 * 3.14159265358979323846 * 1e-3 * radius * result.velocity);
}

static void test_zick_homsy(void **state) {
    (void)state;
    const double middle[3] = {0, 0, 0}, aside[3] = {0.25, 0.5, 0.15};
    const double k = array_drag(0.125, 24, 1.0, FILTRATION_D3Q19, FILTRATION_DOUBLE, FILTRATION_CENTRAL_LINEAR, middle);
    assert_true(fabs(k / 4.2916 - 1.0) < 0.006);
    assert_true(fabs(array_drag(0.125, 24, 3.5, 0, 0, 0, middle) / k - 1.0) < 1e-4);
    assert_true(fabs(array_drag(0.125, 24, 3.5, 0, FILTRATION_FLOAT, 0, middle) / k - 1.0) < 1e-4);
    assert_true(fabs(array_drag(0.125, 24, 3.5, FILTRATION_D3Q15, 0, 0, middle) / 4.2916 - 1.0) < 0.008);
    assert_true(fabs(array_drag(0.125, 24, 3.5, 0, 0, FILTRATION_HALF_WAY, middle) / 4.2916 - 1.023) <
                0.003); /* the staircase's own value */
    assert_true(fabs(array_drag(0.064, 30, 3.5, 0, 0, 0, aside) / 2.8102 - 1.0) < 0.006);
    assert_true(fabs(array_drag(0.216, 20, 3.5, 0, 0, 0, aside) / 7.442 - 1.0) < 0.006);
    /* touching, as wide as the box: 42.14; coarse, because there are few nodes between them */
    assert_true(fabs(array_drag(3.14159265358979 / 6.0, 20, 3.5, 0, 0, 0, middle) / 42.14 - 1.0) < 0.03);
}

/* RIDDLE_FINE (scripts/verify filtration_arrays): three solid fractions at 20 and 40 cells a diameter, four places of
   the centre within a voxel, and at 20 relaxation times 0.6 to 5, both precisions and lattices. At 40 in floats with
   the largest step, to save time. */
static void test_fine_arrays(void **state) {
    (void)state;
    const double c[] = {0.064, 0.125, 0.216}, drag[] = {2.8102, 4.2916, 7.442}, tau[] = {0.6, 1.0, 2.0, 5.0};
    const double place[4][3] = {{0, 0, 0}, {0.25, 0.5, 0.15}, {0.5, 0.5, 0.5}, {0.1, 0.35, 0.7}};
    const int cells[] = {20, 40}, levels = getenv("RIDDLE_FINE") ? 2 : 0;
    for (int level = 0; level < levels; level++) {
        double worst = 0.0, mean = 0.0;
        for (int k = 0; k < 3; k++)
            for (int p = 0; p < 4; p++) {
                const int n = (int)(cells[level] * cbrt(3.14159265358979323846 / (6.0 * c[k])) + 0.5);
                const double error =
                    array_drag(c[k], n, level ? 5.0 : 2.0, FILTRATION_D3Q19,
                               level ? FILTRATION_FLOAT : FILTRATION_DOUBLE, FILTRATION_CENTRAL_LINEAR, place[p]) /
                        drag[k] -
                    1.0;
                worst = fmax(worst, fabs(error)), mean += fabs(error) / 12.0;
            }
        printf("arrays at %d cells a diameter: error %.3f %% at most, %.3f %% on average\n", cells[level],
               100.0 * worst, 100.0 * mean);
        assert_true(worst < (level ? 0.0015 : 0.003));
        assert_true(mean < 0.0015);
    }
    for (int t = 0; t < 4 * (levels > 0); t++) {
        const double at_one =
            array_drag(0.125, 32, 1.0, FILTRATION_D3Q19, FILTRATION_DOUBLE, FILTRATION_CENTRAL_LINEAR, place[1]);
        const double exact =
            array_drag(0.125, 32, tau[t], FILTRATION_D3Q19, FILTRATION_DOUBLE, FILTRATION_CENTRAL_LINEAR, place[1]);
        const double single =
            array_drag(0.125, 32, tau[t], FILTRATION_D3Q19, FILTRATION_FLOAT, FILTRATION_CENTRAL_LINEAR, place[1]);
        const double other =
            array_drag(0.125, 32, tau[t], FILTRATION_D3Q15, FILTRATION_DOUBLE, FILTRATION_CENTRAL_LINEAR, place[1]);
        printf("tau %g over tau 1: %.6f, float over double %.6f, D3Q15 %.3f %%\n", tau[t], exact / at_one,
               single / exact, 100.0 * (other / drag[1] - 1.0));
        assert_true(fabs(exact / at_one - 1.0) < 1e-3);
        assert_true(fabs(single / exact - 1.0) < 1e-4);
        assert_true(fabs(other / drag[1] - 1.0) < 0.004);
    }
}

/* ---- a woven cloth ---- */

/* Resistance [1/m] of the 2/2 twill of 28 um wire and 32 um opening in its unit cell: the mean over four places of the
   weave within a voxel, because coarse voxels see another cloth at each; *spread: the standard deviation
   between them. */
static double cloth_resistance(double voxel, double tau, int boundary, double pressure, double *spread) {
    double sum = 0.0, squares = 0.0;
    for (int place = 0; place < 4; place++) {
        filtration_cloth cloth;
        filtration_fluid_def def = small_box((int)(240e-6 / voxel + 0.5));
        filtration_fluid fluid;
        filtration_permeability_result result;
        assert_int_equal(filtration_cloth_make(&cloth, 28e-6, 32e-6, FILTRATION_TWILL_WEAVE, 120e-6), FILTRATION_OK);
        cloth.offset[0] = cloth.offset[1] = 0.25 * place * voxel;
        def.voxel = voxel, def.tau = tau, def.boundary = (filtration_boundary)boundary,
        def.precision = FILTRATION_FLOAT;
        def.solid = filtration_cloth_solid(&cloth);
        assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
        assert_int_equal(filtration_fluid_permeability(&fluid, NULL, 2, pressure, 3e-4, 1000000, &result),
                         FILTRATION_OK);
        filtration_fluid_free(&fluid);
        sum += result.resistance, squares += result.resistance * result.resistance;
    }
    *spread = sqrt((squares - 0.25 * sum * sum) / 3.0);
    return 0.25 * sum;
}

/* RIDDLE_FINE (scripts/verify cloth): at 2.5 um, creeping and at 1000 Pa. */
static void test_clean_cloth(void **state) {
    (void)state;
    double spread;
    assert_true(fabs(cloth_resistance(7.5e-6, 3.5, FILTRATION_CENTRAL_LINEAR, 1e-3, &spread) / 2.27e6 - 1.0) < 0.04);
    assert_true(spread > 0.05e6 && spread < 0.4e6);
    if (!getenv("RIDDLE_FINE")) return;
    const double expected[2][2] = {{2.27e6, 3.0e6}, {2.41e6, 3.20e6}};
    for (int k = 0; k < 4; k++) {
        const int half_way = k / 2, inertia = k % 2;
        const double found =
            cloth_resistance(2.5e-6, inertia ? 0.7 : 1.0, half_way ? FILTRATION_HALF_WAY : FILTRATION_CENTRAL_LINEAR,
                             inertia ? 1000.0 : 1e-3, &spread);
        printf("twill at 2.5 um, %s, %s: %.3e 1/m, places %.1e (expected %.2e)\n",
               half_way ? "half way" : "central linear", inertia ? "1000 Pa" : "creeping", found, spread,
               expected[half_way][inertia]);
        assert_true(fabs(found / expected[half_way][inertia] - 1.0) < (inertia && !half_way ? 0.05 : 0.03));
    }
}

/* ---- stability ---- */

static double between(uint64_t *state, double low, double high) {
    *state ^= *state << 13, *state ^= *state >> 7, *state ^= *state << 17;
    return low + (high - low) * (double)(*state >> 11) * 0x1p-53;
}

/* Adds a sphere that touches one of those before it and overlaps none, in a periodic box. */
static void touch(double *centre, int i, double radius, double side, uint64_t *state) {
    for (int free_place = 0; !free_place;) {
        double way[3], length = 0.0;
        const int j = (int)between(state, 0.0, i);
        for (int a = 0; a < 3; a++) way[a] = between(state, -1.0, 1.0), length += way[a] * way[a];
        for (int a = 0; a < 3; a++) centre[3 * i + a] = centre[3 * j + a] + 2.0 * radius * way[a] / sqrt(length);
        free_place = 1;
        for (int k = 0; k < i; k++) {
            double square = 0.0;
            for (int a = 0; a < 3; a++) {
                double d = centre[3 * i + a] - centre[3 * k + a];
                d -= side * floor(d / side + 0.5);
                square += d * d;
            }
            free_place = free_place && (k == j || square >= 4.0 * radius * radius);
        }
    }
}

/* Six spheres that touch, thrown about at random and back, at cell Reynolds numbers up to 20 and surface speeds up to
   Mach 0.2: a thousand motions in all. */
static void test_touching_spheres_thrown_about(void **state) {
    (void)state;
    const double tau[] = {0.505, 0.52, 0.6, 1.0, 5.0},
                 speed[] = {0.0096, 0.03, 0.03, 0.03, 0.03}; /* by component [voxels a step] */
    uint64_t random = 88172645463325252u;
    for (int t = 0; t < 5; t++) {
        const double radius = 5e-6;
        double centre[18], velocity[18], spin[18], radii[6], force[18], torque[18];
        filtration_fluid_def def = small_box(32);
        filtration_fluid fluid;
        def.tau = tau[t];
        assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
        for (int a = 0; a < 3; a++) centre[a] = 16e-6;
        for (int i = 0; i < 6; i++) {
            radii[i] = radius;
            if (i) touch(centre, i, radius, 32e-6, &random);
        }
        const filtration_spheres spheres = {6, centre, velocity, spin, radii, force, torque};
        for (int k = 0; k < 400; k++) {
            for (int i = 0; i < 18 && k % 4 == 0; i++) {
                const int back = k % 8 == 4;
                velocity[i] = back ? -velocity[i] : between(&random, -speed[t], speed[t]) * def.voxel / fluid.dt;
                spin[i] = back ? -spin[i] : between(&random, -speed[t], speed[t]) * def.voxel / fluid.dt / radius;
            }
            assert_int_equal(filtration_fluid_step(&fluid, &spheres), FILTRATION_OK);
            for (int i = 0; i < 18; i++) centre[i] += velocity[i] * fluid.dt;
        }
        filtration_fluid_free(&fluid);
    }
}

/* ---- two spheres that approach ---- */

/* Reads speed of the first sphere and force on either from tests/reference/filtration/two_spheres.csv. ratio
   HUGE_VAL: a wall. */
static double exact_force(double ratio, double gap, double *speed) {
    FILE *file = fopen("tests/reference/filtration/two_spheres.csv", "r");
    char line[200];
    if (!file) fail_msg("run in the root of the repository: two_spheres.csv is not there");
    while (fgets(line, sizeof line, file)) {
        double r, h, u, force;
        if (sscanf(line, "%lf,%lf,%lf,%lf", &r, &h, &u, &force) != 4) continue;
        if ((r < HUGE_VAL ? fabs(r - ratio) > 1e-9 : ratio < HUGE_VAL) || fabs(h - gap) > 1e-9) continue;
        fclose(file);
        *speed = u;
        return force;
    }
    fclose(file);
    fail_msg("ratio %g, gap %g: not in two_spheres.csv", ratio, gap);
    return 0.0;
}

/* Force on two spheres of radii 4 and 4 ratio cells (HUGE_VAL: a wall), gap [radii], that approach along a direction at
   a place, over the exact one; with the lubrication that filtration_move adds. */
static double approach_error(double ratio, double gap, const double along[3], const double place[3]) {
    const double R = 4.0, other = ratio < HUGE_VAL ? ratio * R : R, h = gap * R, v = 1e-5;
    double speed = 1.0, length = 0.0, towards = 0.0;
    const double exact = exact_force(ratio, gap, &speed) * 6.0 * 3.14159265358979323846 * R * v;
    const int wall = !(ratio < HUGE_VAL), n = (int)(ratio > 1.0 && !wall ? 6.0 * other : 8.0 * other);
    double centre[6], velocity[6] = {0}, spin[6] = {0}, radius[2] = {R, other}, force[6], torque[6];
    const filtration_spheres spheres = {wall ? 1 : 2, centre, velocity, spin, radius, force, torque};
    filtration_fluid_def def = small_box(n);
    filtration_fluid fluid;
    def.voxel = def.density = def.viscosity = 1.0;
    def.tau = 3.5;
    if (wall) def.face[FILTRATION_LOW_Z] = def.face[FILTRATION_HIGH_Z] = FILTRATION_WALL;
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    for (int a = 0; a < 3; a++) length += along[a] * along[a];
    for (int a = 0; a < 3; a++) {
        const double e = along[a] / sqrt(length), middle = 0.5 * n + place[a];
        centre[a] = middle - e * (R + 0.5 * h), centre[3 + a] = middle + e * (other + 0.5 * h);
        velocity[a] = speed * v * e, velocity[3 + a] = (speed - 1.0) * v * e;
    }
    if (wall) centre[2] = n - R - h;
    assert_int_equal(filtration_fluid_run(&fluid, (int64_t)(2.4 * R * other) * 2, &spheres), FILTRATION_OK);
    for (int a = 0; a < 3; a++)
        towards += (wall ? -force[a] : 0.5 * (force[3 + a] - force[a])) * along[a] / sqrt(length);
    filtration_fluid_free(&fluid);
    return (towards + filtration_lubrication_force(R, wall ? HUGE_VAL : other, h, v, 1.0, 2.0 / 3.0, 1e-9)) / exact -
           1.0;
}

/* Gaps of 0.1 to 2 cells at 8 cells a diameter, wherever the spheres are on the lattice and whichever way they go;
   spheres of unequal size; a wall. */
static void test_two_spheres_approach(void **state) {
    (void)state;
    static const double gaps[] = {0.025, 0.075, 0.125, 0.2, 0.3, 0.5},
                        ways[4][3] = {{0, 0, 1}, {1, -1, 0}, {1, 1, 1}, {0.3, -1, 0.6}},
                        places[4][3] = {{0, 0, 0}, {0.5, 0.5, 0.5}, {0.1, 0.3, 0.45}, {0.25, 0.75, 0.6}};
    double mean = 0.0, worst = 0.0;
    for (int g = 0; g < 6; g++)
        for (int k = 0; k < 8; k++) {
            const double error = approach_error(1.0, gaps[g], ways[k % 4], places[(k + k / 4) % 4]);
            mean += error / 48.0, worst = fmax(worst, fabs(error));
        }
    assert_true(worst < 0.1);
    assert_true(fabs(mean) < 0.03);
    assert_true(fabs(approach_error(2.0, gaps[1], ways[3], places[2])) < 0.06);
    for (int g = 0; g < 6; g += 2)
        for (int k = 0; k < 2; k++) assert_true(fabs(approach_error(HUGE_VAL, gaps[g], ways[0], places[2 * k])) < 0.05);
}

/* ---- a moving sphere ---- */

static void uniform_flow(void *user, const double x[3], double u[3], double *p) {
    (void)x;
    u[0] = u[1] = 0.0;
    u[2] = *(const double *)user;
    *p = 0.0;
}

/* Mean drag over slip velocity in ten voxels of way, in a frame that moves along with the sphere (0) or not (1). */
static double frame_drag(int moves) {
    const int n = 24, lead = 1500, span = 500;
    filtration_fluid_def def = small_box(n);
    filtration_fluid fluid;
    def.body_force[2] = 1e7;
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    double speed = moves ? -0.02 * def.voxel / fluid.dt : 0.0, radius = 5e-6, force[3], torque[3], spin[3] = {0, 0, 0};
    double centre[3] = {12.13e-6, 12.27e-6, 12.4e-6}, velocity[3] = {0, 0, speed}, drag = 0.0, slip = 0.0;
    filtration_spheres spheres = {1, centre, velocity, spin, &radius, force, torque};
    if (moves) assert_int_equal(filtration_fluid_set_flow(&fluid, uniform_flow, &speed), FILTRATION_OK);
    const double porosity = 1.0 - 4.0 / 3.0 * 3.14159265358979323846 * 125.0 / (n * n * n);
    for (int k = 0; k < lead + span; k++) {
        double mean[3];
        assert_int_equal(filtration_fluid_step(&fluid, &spheres), FILTRATION_OK);
        centre[2] += speed * fluid.dt;
        if (k < lead) continue;
        drag += force[2];
        if (k % 10) continue;
        filtration_fluid_mean_velocity(&fluid, mean);
        slip += mean[2] - porosity * speed;
    }
    filtration_fluid_free(&fluid);
    return drag / slip;
}

static void test_frame(void **state) {
    (void)state;
    const double rest = frame_drag(0), moving = frame_drag(1);
    assert_true(fabs(moving / rest - 1.0) < 0.005);
}

/* ---- bits ---- */

/* Ten spheres that spin and move about between walls; hash of the flow and of the forces. */
typedef struct tumble {
    double centre[30], velocity[30], spin[30], radius[10], force[30], torque[30];
    filtration_spheres spheres;
    filtration_fluid fluid;
} tumble;

static double solid_rod(const void *self, const double p[3]) {
    (void)self;
    return sqrt((p[0] - 16e-6) * (p[0] - 16e-6) + (p[1] - 16e-6) * (p[1] - 16e-6)) - 3e-6;
}

static void tumble_start(tumble *t, int threads, int skip, const filtration_memory *memory) {
    filtration_fluid_def def = small_box(32);
    def.face[FILTRATION_LOW_Z] = def.face[FILTRATION_HIGH_Z] = FILTRATION_WALL;
    def.solid.distance = solid_rod;
    def.threads = threads;
    def.skip = skip;
    def.bulk_ratio = 5.0;
    if (memory) def.memory = *memory;
    memset(t, 0, sizeof *t);
    for (int n = 0; n < 10; n++) {
        t->radius[n] = 2.2e-6 + 0.1e-6 * n;
        for (int a = 0; a < 3; a++) {
            t->centre[3 * n + a] = (a == 2 ? 5.0 + 2.2 * n : 3.0 + (7 * n + 11 * a) % 29) * 1e-6;
            t->velocity[3 * n + a] = 0.001 * ((n * 5 + a * 3) % 7 - 3);
            t->spin[3 * n + a] = 300.0 * ((n * 3 + a * 5) % 5 - 2);
        }
    }
    const filtration_spheres s = {10, t->centre, t->velocity, t->spin, t->radius, t->force, t->torque};
    t->spheres = s;
    if (filtration_fluid_init(&t->fluid, &def) != FILTRATION_OK) t->fluid.lattice = NULL;
}

static void tumble_run(tumble *t, int steps) {
    for (int k = 0; k < steps; k++) {
        assert_int_equal(filtration_fluid_step(&t->fluid, &t->spheres), FILTRATION_OK);
        for (int n = 0; n < 30; n++) t->centre[n] += t->velocity[n] * t->fluid.dt * (n % 3 == 2 ? 0.1 : 1.0);
    }
}

static uint64_t add_bits(uint64_t hash, const void *data, size_t bytes) {
    for (size_t k = 0; k < bytes; k++) hash = (hash ^ ((const unsigned char *)data)[k]) * UINT64_C(0x100000001b3);
    return hash;
}

static uint64_t tumble_hash(const tumble *t) {
    uint64_t hash = add_bits(1, t->force, sizeof t->force);
    hash = add_bits(hash, t->torque, sizeof t->torque);
    for (int z = 0; z < 32; z++)
        for (int y = 0; y < 32; y++)
            for (int x = 0; x < 32; x++) {
                filtration_sample s;
                filtration_fluid_at(&t->fluid, x, y, z, &s);
                hash = add_bits(hash, s.velocity, sizeof s.velocity);
                hash = add_bits(hash, &s.pressure, sizeof s.pressure);
            }
    return hash;
}

/* Tasks in reverse, as another number of threads might do them. */
static void backwards(void *user, int tasks, void (*task)(void *context, int index), void *context) {
    (void)user;
    for (int k = tasks - 1; k >= 0; k--) task(context, k);
}

static void test_same_bits(void **state) {
    (void)state;
    tumble *a = (tumble *)malloc(sizeof *a), *b = (tumble *)malloc(sizeof *b);
    tumble_start(a, 1, 1, NULL);
    tumble_run(a, 101);
    for (int k = 0; k < 3; k++) {
        tumble_start(b, k == 0 ? 2 : 1, k != 1, NULL);
        if (k == 2) b->fluid.def.parallel.fn = backwards;
        tumble_run(b, 101);
        assert_true(tumble_hash(a) == tumble_hash(b));
        filtration_fluid_free(&b->fluid);
    }
    filtration_fluid_free(&a->fluid);
    free(a);
    free(b);
}

typedef struct bytes {
    unsigned char *data;
    size_t size, room, at, limit;
} bytes;

static int write_bytes(void *user, const void *data, size_t n) {
    bytes *b = (bytes *)user;
    if (b->size + n > b->limit) return 0;
    if (b->size + n > b->room) {
        b->room = 2 * (b->size + n);
        b->data = (unsigned char *)realloc(b->data, b->room);
    }
    memcpy(b->data + b->size, data, n);
    b->size += n;
    return 1;
}

static int read_bytes(void *user, void *data, size_t n) {
    bytes *b = (bytes *)user;
    if (b->at + n > b->size) return 0;
    memcpy(data, b->data + b->at, n);
    b->at += n;
    return 1;
}

static void test_resume(void **state) {
    (void)state;
    tumble *a = (tumble *)malloc(sizeof *a), *b = (tumble *)malloc(sizeof *b);
    bytes saved = {NULL, 0, 0, 0, (size_t)-1 / 2};
    tumble_start(a, 1, 1, NULL);
    tumble_run(a, 33);
    assert_int_equal(filtration_fluid_save(&a->fluid, write_bytes, &saved), FILTRATION_OK);
    tumble_start(b, 1, 1, NULL);
    assert_int_equal(filtration_fluid_load(&b->fluid, read_bytes, &saved), FILTRATION_OK);
    memcpy(b->centre, a->centre, sizeof a->centre);
    tumble_run(a, 20);
    tumble_run(b, 20);
    assert_true(tumble_hash(a) == tumble_hash(b));
    assert_int_equal(a->fluid.steps, b->fluid.steps);
    /* of another boundary law, refill, bulk viscosity or Lambda */
    filtration_fluid_def def = b->fluid.def;
    filtration_fluid other;
    for (int k = 0; k < 4; k++) {
        filtration_fluid_def changed = def;
        if (k == 0) changed.boundary = FILTRATION_HALF_WAY;
        if (k == 1) changed.refill = FILTRATION_REFILL_EQUILIBRIUM;
        if (k == 2) changed.bulk_ratio = 6.0;
        if (k == 3) changed.magic = 0.25;
        saved.at = 0;
        assert_int_equal(filtration_fluid_init(&other, &changed), FILTRATION_OK);
        assert_int_equal(filtration_fluid_load(&other, read_bytes, &saved), FILTRATION_BAD_DATA);
        filtration_fluid_free(&other);
    }
    /* damaged, cut off, refused */
    saved.at = 0;
    saved.data[saved.size / 2] ^= 1;
    assert_int_equal(filtration_fluid_load(&b->fluid, read_bytes, &saved), FILTRATION_BAD_DATA);
    assert_int_equal(b->fluid.steps, 0);
    saved.at = 0, saved.size /= 3;
    assert_int_equal(filtration_fluid_load(&b->fluid, read_bytes, &saved), FILTRATION_STREAM);
    saved.at = 0, saved.size = 0, saved.limit = 100;
    assert_int_equal(filtration_fluid_save(&a->fluid, write_bytes, &saved), FILTRATION_STREAM);
    filtration_fluid_free(&a->fluid);
    filtration_fluid_free(&b->fluid);
    free(saved.data);
    free(a);
    free(b);
}

/* ---- changes during a run ---- */

static void test_another_time_step(void **state) {
    (void)state;
    filtration_fluid_def def = small_box(8);
    filtration_fluid fluid;
    filtration_sample before, after;
    def.face[FILTRATION_LOW_Z] = def.face[FILTRATION_HIGH_Z] = FILTRATION_WALL;
    def.body_force[0] = 1e4;
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    assert_int_equal(filtration_fluid_run(&fluid, 1501, NULL), FILTRATION_OK);
    filtration_fluid_at(&fluid, 1, 1, 2, &before);
    assert_int_equal(filtration_fluid_set_tau(&fluid, 2.5), FILTRATION_OK);
    filtration_fluid_at(&fluid, 1, 1, 2, &after);
    assert_true(fabs(after.velocity[0] / before.velocity[0] - 1.0) < 1e-6);
    assert_int_equal(filtration_fluid_run(&fluid, 3, NULL), FILTRATION_OK);
    filtration_fluid_at(&fluid, 1, 1, 2, &after);
    assert_true(fabs(after.velocity[0] / before.velocity[0] - 1.0) < 1e-3);
    assert_int_equal(filtration_fluid_set_tau(&fluid, 0.5), FILTRATION_BAD_ARGUMENT);
    /* another Lambda: the flow stays, odd parts relax otherwise */
    fluid.def.magic = 0.25;
    assert_int_equal(filtration_fluid_set_tau(&fluid, 2.5), FILTRATION_OK);
    assert_true(fabs(fluid.lattice->rates.minus - 1.0 / (0.5 + 0.25 / 2.0)) < 1e-15);
    filtration_fluid_at(&fluid, 1, 1, 2, &before);
    assert_true(fabs(after.velocity[0] / before.velocity[0] - 1.0) < 1e-12);
    filtration_fluid_free(&fluid);
}

static void test_mass(void **state) {
    (void)state;
    tumble *t = (tumble *)malloc(sizeof *t);
    tumble_start(t, 1, 1, NULL);
    t->spheres.n = 0;
    const double start = filtration_fluid_mass(&t->fluid);
    assert_int_equal(filtration_fluid_run(&t->fluid, 50, NULL), FILTRATION_OK);
    assert_true(filtration_fluid_mass(&t->fluid) == start); /* at rest: nothing happens */
    t->spheres.n = 10;
    tumble_run(t, 100);
    const double nodes = filtration_fluid_porosity(&t->fluid) * 32 * 32 * 32 * 1e-15;
    assert_true(fabs(filtration_fluid_mass(&t->fluid) / nodes - 1.0) < 1e-2);
    assert_int_equal(filtration_fluid_keep_mass(&t->fluid), FILTRATION_OK);
    assert_true(fabs(filtration_fluid_mass(&t->fluid) / nodes - 1.0) < 1e-12);
    filtration_fluid_free(&t->fluid);
    /* by itself in a closed box, at step 256 */
    for (int keep = 0; keep < 2; keep++) {
        tumble_start(t, 1, 1, NULL);
        t->fluid.def.keep_mass = keep;
        tumble_run(t, 256);
        const double liquid = filtration_fluid_porosity(&t->fluid) * 32 * 32 * 32 * 1e-15;
        assert_true((fabs(filtration_fluid_mass(&t->fluid) / liquid - 1.0) < 1e-12) == (keep == 1));
        filtration_fluid_free(&t->fluid);
    }
    free(t);
}

/* ---- spheres moved here ---- */

static void test_settling(void **state) {
    (void)state;
    filtration_fluid_def def = small_box(20);
    filtration_motion_def motion = filtration_motion_default_def();
    filtration_fluid fluid;
    def.voxel = 10e-6;
    def.nodes[2] = 40;
    def.tau = 2.0;
    for (int f = 0; f < 6; f++) def.face[f] = FILTRATION_WALL;
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    double centre[3] = {100e-6, 100e-6, 250e-6}, velocity[3] = {0, 0, 0}, spin[3] = {0, 0, 0}, radius = 40e-6, force[3],
           torque[3];
    double fastest = 0.0;
    filtration_spheres spheres = {1, centre, velocity, spin, &radius, force, torque};
    for (int k = 0; k < 4000; k++) {
        assert_int_equal(filtration_fluid_step(&fluid, &spheres), FILTRATION_OK);
        assert_int_equal(filtration_move(&motion, &fluid, &spheres, 1.0, NULL), FILTRATION_OK);
        if (k > 300) fastest = fmax(fastest, -velocity[2]); /* before, sound runs about the box */
    }
    /* between d/L 0.25 (wall factor 1.823) and 0.5 (4.54): at 0.4 the square duct's factor is about 3 */
    const double stokes = 2.0 / 9.0 * 1200.0 * 9.81 * 40e-6 * 40e-6 / 1e-3;
    assert_in_range((int)(1000.0 * fastest / stokes), 300, 370);
    assert_true(centre[2] > 39.9e-6 && centre[2] < 50e-6); /* on the bottom or in the film above it */
    assert_true(fabs(velocity[2]) < 0.02 * fastest);
    filtration_fluid_free(&fluid);
}

/* Force along z on a sphere of 16 cells that is pulled slowly through a closed box of 40 cells, or through a
   quarter of it. */
static double pulled(filtration_force_mode kind, int quarter) {
    filtration_fluid_def def = small_box(40);
    filtration_fluid fluid;
    def.tau = 2.0;
    def.force = kind;
    for (int f = 0; f < 6; f++) def.face[f] = FILTRATION_WALL;
    if (quarter) {
        def.nodes[0] = def.nodes[1] = 20;
        def.face[FILTRATION_LOW_X] = def.face[FILTRATION_LOW_Y] = FILTRATION_SYMMETRY;
    }
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    const double axis = quarter ? 0.0 : 20.0 * def.voxel, speed = 2e-3 * def.voxel / fluid.dt;
    double centre[3] = {axis, axis, 19.0 * def.voxel}, velocity[3] = {0, 0, speed}, spin[3] = {0, 0, 0},
           radius = 8.0 * def.voxel;
    double force[3], torque[3];
    filtration_spheres spheres = {1, centre, velocity, spin, &radius, force, torque};
    for (int k = 0; k < 500; k++) {
        assert_int_equal(filtration_fluid_step(&fluid, &spheres), FILTRATION_OK);
        centre[2] += speed * fluid.dt;
    }
    filtration_fluid_free(&fluid);
    return (quarter ? 4.0 : 1.0) * force[2];
}

/* The paper's force is that of shear alone: two thirds of Stokes' drag, and 1.5 voxels over the radius less. */
/* A dry sphere meets a wall and leaves it with the restitution asked, at any speed, size and stiffness. */
static void test_restitution(void **state) {
    (void)state;
    static const double asked[] = {0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 1.0};
    for (int k = 0; k < 7; k++) {
        filtration_fluid_def def = small_box(16);
        filtration_motion_def motion = filtration_motion_default_def();
        filtration_fluid fluid;
        def.voxel = 1e-5;
        for (int f = 0; f < 6; f++) def.face[f] = FILTRATION_WALL;
        assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
        const double speed = k % 2 ? 0.05 : 0.2;
        motion.gravity[2] = 0.0, motion.restitution = asked[k], motion.lubrication = 0, motion.sub_steps = 20000;
        motion.modulus = k % 3 ? 1e8 : 1e9;
        double r = k % 2 ? 2e-5 : 4e-5, x[3] = {8e-5, 8e-5, r + 1e-9}, v[3] = {0, 0, -speed}, w[3] = {0},
               force[3] = {0}, torque[3] = {0};
        filtration_spheres s = {1, x, v, w, &r, force, torque};
        for (int n = 0; n < 2; n++) assert_int_equal(filtration_move(&motion, &fluid, &s, 1.0, NULL), FILTRATION_OK);
        assert_true(x[2] > r && fabs(v[2] / speed - asked[k]) < 0.005);
        filtration_fluid_free(&fluid);
    }
}

/* Presses a sphere into a pore; returns its speed and the speed of its surface after a while [m/s]. */
static double speed_in_pore(const filtration_solid *solid, double x, double y, double z, double radius,
                            double friction) {
    filtration_fluid_def def = small_box(32);
    filtration_motion_def motion = filtration_motion_default_def();
    filtration_fluid fluid;
    def.voxel = 7.5e-6, def.tau = 0.55, def.nodes[2] = 20;
    def.face[4] = def.face[5] = FILTRATION_PRESSURE;
    def.solid = *solid;
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    motion.gravity[2] = 0.0, motion.sub_steps = 20, motion.friction = friction;
    double centre[3] = {x, y, z + radius}, v[3] = {0}, w[3] = {0}, force[3] = {0, 0, -1e-6}, torque[3] = {0},
           contact[3];
    filtration_spheres s = {1, centre, v, w, &radius, force, torque};
    for (int n = 0; n < 2600; n++) assert_int_equal(filtration_move(&motion, &fluid, &s, 1.0, contact), FILTRATION_OK);
    filtration_fluid_free(&fluid);
    assert_true(fabs(contact[2] / 1e-6 - 1.0) < 1e-3);
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + radius * sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
}

/* A sphere touches every wire, fibre and sphere of the solid that it can: it comes to rest on them. */
static void test_sphere_in_pore_rests(void **state) {
    (void)state;
    static const double a[9] = {60e-6, 60e-6, 50e-6, 130e-6, 70e-6, 50e-6, 90e-6, 130e-6, 55e-6},
                        r[3] = {40e-6, 38e-6, 36e-6};
    static const double box[3] = {240e-6, 240e-6, 150e-6};
    static const int periodic[3] = {1, 1, 0};
    filtration_cloth cloth;
    filtration_bed bed;
    assert_int_equal(filtration_cloth_make(&cloth, 28e-6, 32e-6, FILTRATION_TWILL_WEAVE, 60e-6), FILTRATION_OK);
    filtration_solid solid = filtration_cloth_solid(&cloth);
    assert_true(speed_in_pore(&solid, 61e-6, 59.5e-6, 88e-6, 40e-6, 0.3) < 2e-7);
    assert_true(speed_in_pore(&solid, 110e-6, 20e-6, 88e-6, 30e-6, 0.1) < 2e-7);
    assert_int_equal(filtration_bed_init(&bed, 3, a, NULL, r, box, periodic, 60e-6, NULL), FILTRATION_OK);
    solid = filtration_bed_solid(&bed);
    assert_true(speed_in_pore(&solid, 95e-6, 85e-6, 92e-6, 40e-6, 0.3) < 2e-7);
    filtration_bed_free(&bed);
}

/* The places of a cloth agree with its distance: the nearest of them is the nearest point. */
static void test_places_of_a_cloth(void **state) {
    (void)state;
    filtration_cloth cloth;
    filtration_near near[8];
    for (int weave = 0; weave < 2; weave++) {
        assert_int_equal(filtration_cloth_make(&cloth, 28e-6, 32e-6, (filtration_weave)weave, 60e-6), FILTRATION_OK);
        const filtration_solid solid = filtration_cloth_solid(&cloth);
        for (int k = 0; k < 300; k++) {
            const double point[3] = {(k * 37 % 241) * 1e-6, (k * 53 % 239) * 1e-6,
                                     (60.0 + (k * 29 % 97) - 48.0) * 1e-6};
            const double away = filtration_cloth_distance(&cloth, point);
            if (!(away > 1e-6 && away < 25e-6)) continue;
            const int n = solid.touch(&cloth, point, away - 0.5e-6, 1e-6, 8, near);
            double least = HUGE_VAL;
            assert_true(n >= 1);
            for (int i = 0; i < n; i++) {
                if (near[i].gap < least) least = near[i].gap;
                double surface[3];
                for (int a = 0; a < 3; a++) surface[a] = point[a] + near[i].normal[a] * (away - 0.5e-6 + near[i].gap);
                assert_true(fabs(filtration_cloth_distance(&cloth, surface)) < 1e-11);
            }
            assert_true(fabs(least - 0.5e-6) < 1e-12);
        }
    }
}

static void test_shear_layer(void **state) {
    (void)state;
    const double drag = pulled(FILTRATION_MOMENTUM_EXCHANGE, 0), shear = pulled(FILTRATION_SHEAR_LAYER, 0);
    assert_true(drag < 0.0);
    assert_true(fabs(pulled(FILTRATION_MOMENTUM_EXCHANGE, 1) / drag - 1.0) < 1e-3);
    assert_true(fabs(pulled(FILTRATION_SHEAR_LAYER, 1) / shear - 1.0) < 0.02);
    assert_true(shear / drag > 0.40 && shear / drag < 0.60); /* 0.54 far from walls */
}

/* ---- what goes wrong ---- */

static void test_divergence_is_reported(void **state) {
    (void)state;
    filtration_fluid_def def = small_box(12);
    filtration_fluid fluid;
    def.tau = 0.505;
    def.body_force[0] = 1e12;
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    assert_int_equal(filtration_fluid_run(&fluid, 100000, NULL), FILTRATION_DIVERGED);
    assert_int_equal(fluid.problem.cause, FILTRATION_SPEED);
    assert_true(fluid.problem.speed >= 0.3 && fluid.problem.cell_reynolds > 100.0);
    assert_int_equal(fluid.problem.step, fluid.steps);
    assert_int_equal(filtration_fluid_step(&fluid, NULL), FILTRATION_DIVERGED);
    filtration_fluid_free(&fluid);
}

static void test_bad_input(void **state) {
    (void)state;
    filtration_fluid_def def = small_box(12), bad;
    const char *field = NULL;
    filtration_fluid fluid;
    assert_int_equal(filtration_fluid_check_def(NULL, &field), FILTRATION_BAD_DEF);
    assert_string_equal(field, "def");
#define REFUSED(what, name)                                                                                            \
    bad = def;                                                                                                         \
    what;                                                                                                              \
    assert_int_equal(filtration_fluid_check_def(&bad, &field), FILTRATION_BAD_DEF);                                    \
    assert_string_equal(field, name);                                                                                  \
    assert_int_equal(filtration_fluid_init(&fluid, &bad), FILTRATION_BAD_DEF)
    REFUSED(bad.cookie = 0, "cookie");
    REFUSED(bad.nodes[1] = 0, "nodes");
    REFUSED(bad.voxel = (double)NAN, "voxel");
    REFUSED(bad.tau = 0.5, "tau");
    REFUSED(bad.viscosity = HUGE_VAL, "viscosity");
    REFUSED(bad.face[0] = FILTRATION_WALL, "face");
    REFUSED(bad.face[4] = bad.face[5] = (filtration_face)17, "face");
    REFUSED(bad.face[4] = FILTRATION_WALL; bad.face[5] = (filtration_face)-1, "face");
    REFUSED(bad.face_velocity[4][2] = 1.0, "face_velocity");
    REFUSED(bad.body_force[2] = (double)NAN, "body_force");
    REFUSED(bad.precision = FILTRATION_FLOAT; bad.lattice = FILTRATION_D3Q15, "precision");
    REFUSED(bad.threads = 0, "threads");
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    double centre[3] = {(double)NAN, 0, 0}, zero[3] = {0, 0, 0}, radius = 3e-6, force[3], torque[3];
    filtration_spheres s = {1, centre, zero, zero, &radius, force, torque};
    assert_int_equal(filtration_fluid_step(&fluid, &s), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(fluid.problem.cause, FILTRATION_SPHERE);
    centre[0] = 6e-6;
    radius = 1e-300;
    assert_int_equal(filtration_fluid_step(&fluid, &s), FILTRATION_OK);
    radius = 3e-6;
    assert_int_equal(filtration_fluid_step(&fluid, &s), FILTRATION_OK);
    centre[0] += 0.8e-6;
    assert_int_equal(filtration_fluid_step(&fluid, &s), FILTRATION_TOO_FAST);
    s.n = 0;
    assert_int_equal(filtration_fluid_step(&fluid, &s), FILTRATION_OK);
    assert_int_equal(filtration_fluid_run(&fluid, -1, NULL), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_fluid_run(&fluid, 0, NULL), FILTRATION_OK);
    filtration_fluid_free(&fluid);
    assert_int_equal(filtration_fluid_run(&fluid, 0, NULL), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_fluid_run(NULL, 0, NULL), FILTRATION_BAD_ARGUMENT);
    assert_true(filtration_fluid_bytes(&def) > 12.0 * 12 * 12 * 19 * 8);
    assert_true(filtration_lubrication_force(1e-5, HUGE_VAL, 1e-7, 1e-3, 1e-3, 1e-6, 1e-8) > 0.0);
    assert_true(isnan(filtration_lubrication_force(1e-5, HUGE_VAL, (double)NAN, 1e-3, 1e-3, 1e-6, 1e-8)));
}

static void flow_of(void *user, const double point[3], double velocity[3], double *pressure) {
    const double *value = (const double *)user;
    (void)point;
    velocity[0] = value[0], velocity[1] = velocity[2] = 0.0, *pressure = value[1];
}

/* Finite numbers whose products are not are refused where they enter, and then nothing has changed. */
static void test_products_that_overflow(void **state) {
    (void)state;
    const double huge[] = {1e80, 1e200, -1e308, DBL_MAX};
    for (int single = 0; single < 2; single++) {
        filtration_fluid_def def = small_box(12), bad;
        filtration_fluid fluid, live;
        const char *field = NULL;
        if (single) def.precision = FILTRATION_FLOAT;
        def.face[0] = def.face[1] = FILTRATION_PRESSURE, def.face[4] = def.face[5] = FILTRATION_WALL;
        def.face_pressure[0] = 0.1;
        assert_int_equal(filtration_fluid_init(&live, &def), FILTRATION_OK);
        assert_int_equal(filtration_fluid_run(&live, 10, NULL), FILTRATION_OK);
        const double mass = filtration_fluid_mass(&live), speed = filtration_fluid_max_speed(&live);
        for (size_t k = 0; k < sizeof huge / sizeof *huge; k++) {
            REFUSED(bad.face_pressure[1] = huge[k], "face_pressure");
            REFUSED(bad.face_velocity[5][1] = huge[k], "face_velocity");
            REFUSED(bad.body_force[1] = huge[k], "body_force");
            REFUSED(bad.voxel = fabs(huge[k]), "voxel");
            REFUSED(bad.density = 1.0 / fabs(huge[k]), "density");
            REFUSED(bad.viscosity = fabs(huge[k]), "viscosity");
            const double vector[3] = {0.0, huge[k], 0.0};
            double fast[2] = {huge[k], 0.0}, pressed[2] = {0.0, huge[k]};
            assert_int_equal(filtration_fluid_set_body_force(&live, vector), FILTRATION_BAD_ARGUMENT);
            assert_int_equal(filtration_fluid_set_face_velocity(&live, 4, vector), FILTRATION_BAD_ARGUMENT);
            assert_int_equal(filtration_fluid_set_face_pressure(&live, 0, huge[k]), FILTRATION_BAD_ARGUMENT);
            assert_int_equal(filtration_fluid_set_flow(&live, flow_of, fast), FILTRATION_BAD_ARGUMENT);
            assert_int_equal(filtration_fluid_set_flow(&live, flow_of, pressed), FILTRATION_BAD_ARGUMENT);
            assert_true(filtration_fluid_mass(&live) == mass && filtration_fluid_max_speed(&live) == speed);
        }
        const double wall[3] = {0.0, 900.0 * def.voxel / live.dt,
                                0.0}; /* finite; a longer time step would make it too fast */
        assert_int_equal(filtration_fluid_set_face_velocity(&live, 4, wall), FILTRATION_OK);
        assert_int_equal(filtration_fluid_set_tau(&live, 20.0), FILTRATION_BAD_ARGUMENT);
        assert_true(filtration_fluid_mass(&live) == mass && live.def.tau == def.tau);
        assert_int_equal(filtration_fluid_run(&live, 3, NULL), FILTRATION_DIVERGED);
        assert_true(live.problem.cause == FILTRATION_SPEED && live.problem.node[2] == 0);
        filtration_fluid_free(&live);
    }
}

/* A step that refuses a sphere moves none of the others. A move refuses numbers that would make a speed infinite, and
   tells when a contact does. */
static void test_refused_spheres(void **state) {
    (void)state;
    const double bad[] = {1e80, 1e200, -1e308, (double)NAN, HUGE_VAL};
    const filtration_fluid_def def = small_box(12);
    filtration_motion_def motion = filtration_motion_default_def();
    filtration_fluid fluid;
    double centre[6] = {3e-6, 3e-6, 3e-6, 8e-6, 8e-6, 8e-6}, velocity[6] = {0}, spin[6] = {0}, radius[2] = {2e-6, 2e-6},
           force[6] = {0};
    double torque[6] = {0}, *const number[] = {centre + 4, velocity + 3, spin + 5, radius + 1, force + 3, torque + 5};
    filtration_spheres s = {2, centre, velocity, spin, radius, force, torque};
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    assert_int_equal(filtration_fluid_step(&fluid, &s), FILTRATION_OK);
    const double porosity = filtration_fluid_porosity(&fluid), place = centre[0];
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        for (size_t which = 0; which < sizeof number / sizeof *number; which++) {
            const double kept = *number[which];
            *number[which] = bad[k];
            centre[0] = place + 0.3e-6;
            if (which < 4) {
                assert_int_equal(filtration_fluid_step(&fluid, &s), FILTRATION_BAD_ARGUMENT);
                assert_int_equal(fluid.problem.node[0], 1);
                static const char *const rule[] = {"centre:", "velocity:", "spin:", "radius:"};
                assert_ptr_equal(strstr(fluid.problem.rule, rule[which]), fluid.problem.rule);
            }
            if (k > 0) assert_int_equal(filtration_move(&motion, &fluid, &s, 1.0, NULL), FILTRATION_BAD_ARGUMENT);
            assert_true(filtration_fluid_porosity(&fluid) == porosity && velocity[0] == 0.0 &&
                        centre[0] == place + 0.3e-6);
            centre[0] = place, *number[which] = kept;
        }
    motion.density = 390.0; /* lighter than 0.4 of the liquid */
    assert_int_equal(filtration_move(&motion, &fluid, &s, 1.0, NULL), FILTRATION_BAD_ARGUMENT);
    motion.density = 1e-5, motion.gravity[2] = 1e308;
    assert_int_equal(filtration_move(&motion, &fluid, &s, 1.0, NULL), FILTRATION_BAD_ARGUMENT);
    motion = filtration_motion_default_def(), motion.least_gap = 1e-308;
    assert_int_equal(filtration_move(&motion, &fluid, &s, 1.0, NULL), FILTRATION_BAD_ARGUMENT);
    motion = filtration_motion_default_def(), motion.modulus = 1e308, centre[3] = centre[4] = centre[5] = 4e-6;
    assert_int_equal(filtration_move(&motion, &fluid, &s, 1.0, NULL), FILTRATION_TOO_FAST);
    filtration_fluid_free(&fluid);
}

static void test_failing_memory(void **state) {
    (void)state;
    tumble *t = (tumble *)malloc(sizeof *t);
    for (int k = 0;; k++) {
        failing_allocator memory;
        failing_init_at(&memory, k);
        const filtration_memory hook = {failing_fn, &memory};
        tumble_start(t, 1, 1, &hook);
        if (t->fluid.lattice) {
            const filtration_status status = filtration_fluid_step(&t->fluid, &t->spheres);
            assert_int_equal(status, memory.has_failed ? FILTRATION_NO_MEMORY : FILTRATION_OK);
            filtration_fluid_free(&t->fluid);
        }
        assert_int_equal(failing_live(&memory), 0);
        if (!memory.has_failed) break;
    }
    free(t);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plates),
        cmocka_unit_test(test_pressure_and_mirror),
        cmocka_unit_test(test_pressure_has_no_level),
        cmocka_unit_test(test_films_keep_momentum),
        cmocka_unit_test(test_vortex_is_second_order),
        cmocka_unit_test(test_zick_homsy),
        cmocka_unit_test(test_fine_arrays),
        cmocka_unit_test(test_clean_cloth),
        cmocka_unit_test(test_touching_spheres_thrown_about),
        cmocka_unit_test(test_two_spheres_approach),
        cmocka_unit_test(test_frame),
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_resume),
        cmocka_unit_test(test_another_time_step),
        cmocka_unit_test(test_mass),
        cmocka_unit_test(test_settling),
        cmocka_unit_test(test_restitution),
        cmocka_unit_test(test_sphere_in_pore_rests),
        cmocka_unit_test(test_places_of_a_cloth),
        cmocka_unit_test(test_shear_layer),
        cmocka_unit_test(test_divergence_is_reported),
        cmocka_unit_test(test_bad_input),
        cmocka_unit_test(test_products_that_overflow),
        cmocka_unit_test(test_refused_spheres),
        cmocka_unit_test(test_failing_memory),
    };
    if (getenv("RIDDLE_TEST")) cmocka_set_test_filter(getenv("RIDDLE_TEST"));
    return cmocka_run_group_tests(tests, NULL, NULL);
}
