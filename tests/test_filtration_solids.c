/* filtration.h, solids: signed distances against closed forms and brute force, fractions of links, open area, voxel
   images, failing allocators, bad input. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include "near.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "failing_allocator.h"
#include "filtration.h"
#include "../examples/common/random.h"

static const double um = 1e-6;
static uint64_t stream = 1;

static double uniform(void) { return random_inner(&stream); }

/* ---- cloth ---- */

static filtration_cloth the_twill(void) {
    filtration_cloth cloth;
    assert_int_equal(filtration_cloth_make(&cloth, 28 * um, 32 * um, FILTRATION_TWILL_WEAVE, 0.0), FILTRATION_OK);
    return cloth;
}

static void test_cloth_numbers(void **state) {
    (void)state;
    filtration_cloth cloth = the_twill();
    near(filtration_cloth_period(&cloth), 240 * um, 1e-18);
    near(filtration_cloth_open_area(&cloth), (32.0 / 60.0) * (32.0 / 60.0), 1e-15);
    near(filtration_cloth_thickness(&cloth), 56 * um, 1e-18);
    cloth.weave = FILTRATION_PLAIN_WEAVE;
    near(filtration_cloth_period(&cloth), 120 * um, 1e-18);
}

/* Where warp wire 0 passes over wefts 0 and 1 it is straight: distances of a straight cylinder. */
static void test_cloth_crossings(void **state) {
    (void)state;
    const filtration_cloth cloth = the_twill();
    const double above[3] = {30 * um, 60 * um, 44 * um}, aside[3] = {55 * um, 60 * um, 14 * um},
                 in[3] = {30 * um, 60 * um, 20 * um};
    near(filtration_cloth_distance(&cloth, above), 16 * um, 1e-15);
    assert_true(filtration_cloth_distance(&cloth, in) <= -6 * um &&
                filtration_cloth_distance(&cloth, in) >= -8 * um - 1e-15);
    assert_true(filtration_cloth_distance(&cloth, aside) <= 11 * um + 1e-15);
    /* axes at +-14 um: two wires of 28 um touch at every crossing, and nowhere overlap */
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            const double centre[3] = {(i + 0.5) * 60 * um, (j + 0.5) * 60 * um, 0.0};
            near(filtration_cloth_distance(&cloth, centre), 0.0, 1e-15);
            const double side = (i + j) % 4 < 2 ? 1.0 : -1.0;
            double top[3] = {centre[0] + 10 * um, centre[1],
                             side * 14 * um}; /* 10 um from the axis of the warp, inside it */
            assert_true(filtration_cloth_distance(&cloth, top) < -3 * um &&
                        filtration_cloth_distance(&cloth, top) >= -4 * um - 1e-15);
        }
}

/* Outside: the nearest of many discs. Inside: the sign, and no more than the distance across the wire. */
static void test_cloth_against_brute_force(void **state) {
    (void)state;
    for (int weave = 0; weave < 2; weave++) {
        filtration_cloth cloth = the_twill();
        cloth.weave = weave ? FILTRATION_TWILL_WEAVE : FILTRATION_PLAIN_WEAVE;
        cloth.centre = 100 * um;
        double worst = 0.0;
        for (int trial = 0; trial < 60; trial++) {
            const double p[3] = {(uniform() - 0.5) * 480 * um, (uniform() - 0.5) * 480 * um,
                                 100 * um + (uniform() - 0.5) * 200 * um};
            double least = 1.0;
            for (int warp = 0; warp < 2; warp++)
                for (int i = -8; i < 8; i++) {
                    const double across = p[warp ? 0 : 1] - (i + 0.5) * 60 * um, along = p[warp ? 1 : 0];
                    if (fabs(across) > 150 * um) continue;
                    for (int k = -3000; k <= 3000; k++) {
                        const double s = along + k * 0.05 * um, place = s / (60 * um) - 0.5;
                        const int j = (int)floor(place), mod = weave ? 4 : 2, half = weave ? 2 : 1;
                        const int here = ((i + j) % mod + mod) % mod < half ? 1 : -1,
                                  next = ((i + j + 1) % mod + mod) % mod < half ? 1 : -1;
                        const double side = warp ? 1.0 : -1.0;
                        const double z =
                            100 * um + side * 14 * um * (here == next ? here : here * cos(RIDDLE_PI * (place - j)));
                        const double away = z - p[2];
                        const double d = sqrt(across * across + away * away + (s - along) * (s - along)) - 14 * um;
                        if (d < least) least = d;
                    }
                }
            const double got = filtration_cloth_distance(&cloth, p);
            worst = fmax(worst, fabs(got - least));
        }
        assert_true(worst < 1e-3 * um);
    }
}

static void test_cloth_repeats_and_is_open(void **state) {
    (void)state;
    const filtration_cloth cloth = the_twill();
    for (int k = 0; k < 200; k++) {
        const double p[3] = {uniform() * 240 * um, uniform() * 240 * um, (uniform() - 0.5) * 80 * um};
        const double q[3] = {p[0] - 240 * um, p[1] + 480 * um, p[2]};
        near(filtration_cloth_distance(&cloth, p), filtration_cloth_distance(&cloth, q), 1e-15);
    }
    /* seen from above: a line of sight through the cloth is free over the squares of 32 um, and nowhere else */
    int open = 0;
    const int rays = 60;
    for (int i = 0; i < rays; i++)
        for (int j = 0; j < rays; j++) {
            double least = 1.0;
            for (int k = -28; k <= 28; k++) {
                const double p[3] = {(i + 0.5) * 240 * um / rays, (j + 0.5) * 240 * um / rays, k * um};
                least = fmin(least, filtration_cloth_distance(&cloth, p));
            }
            open += least > 0.0;
        }
    near((double)open / (rays * rays), 1024.0 / 3600.0, 0.01);
    for (int k = 0; k < 1000; k++) { /* a distance: never changes faster than the place, so it is never too large */
        const double p[3] = {uniform() * um * 240, uniform() * um * 240, (uniform() - 0.5) * um * 300};
        const double q[3] = {p[0] + (uniform() - 0.5) * 9 * um, p[1] + (uniform() - 0.5) * 9 * um,
                             p[2] + (uniform() - 0.5) * 9 * um};
        const double way =
            sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
        assert_true(fabs(filtration_cloth_distance(&cloth, p) - filtration_cloth_distance(&cloth, q)) <=
                    way * (1 + 1e-9) + 1e-12);
    }
}

static void test_bad_cloth(void **state) {
    (void)state;
    filtration_cloth cloth;
    const double bad[] = {NAN, 0.0, -1.0, HUGE_VAL};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(filtration_cloth_make(&cloth, bad[i], 1, FILTRATION_TWILL_WEAVE, 0), FILTRATION_BAD_ARGUMENT);
        assert_int_equal(filtration_cloth_make(&cloth, 1, bad[i], FILTRATION_TWILL_WEAVE, 0), FILTRATION_BAD_ARGUMENT);
    }
    assert_int_equal(filtration_cloth_make(&cloth, 1, 1, FILTRATION_TWILL_WEAVE, NAN), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_cloth_make(&cloth, 1, 1, (filtration_weave)7, 0), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_cloth_make(NULL, 1, 1, FILTRATION_TWILL_WEAVE, 0), FILTRATION_BAD_ARGUMENT);
}

/* ---- beds ---- */

enum { MANY = 60 };
static const double box[3] = {3e-4, 2e-4, 4e-4};

static void test_spheres(void **state) {
    (void)state;
    double centre[3 * MANY], radius[MANY];
    for (int i = 0; i < MANY; i++) {
        radius[i] = (5 + 20 * uniform()) * um;
        for (int k = 0; k < 3; k++) centre[3 * i + k] = uniform() * box[k];
    }
    for (int wraps = 0; wraps < 8; wraps++) {
        const int periodic[3] = {wraps & 1, wraps >> 1 & 1, wraps >> 2};
        filtration_bed bed;
        assert_int_equal(filtration_bed_init(&bed, MANY, centre, NULL, radius, box, periodic, 50 * um, NULL),
                         FILTRATION_OK);
        const filtration_solid solid = filtration_bed_solid(&bed);
        for (int trial = 0; trial < 300; trial++) {
            double p[3], least = 50 * um;
            for (int k = 0; k < 3; k++) p[k] = (periodic[k] ? 3 * uniform() - 1 : uniform()) * box[k];
            for (int i = 0; i < MANY; i++) {
                double square = 0.0;
                for (int k = 0; k < 3; k++) {
                    double away = p[k] - centre[3 * i + k];
                    if (periodic[k]) away -= box[k] * floor(away / box[k] + 0.5);
                    square += away * away;
                }
                least = fmin(least, sqrt(square) - radius[i]);
            }
            near(solid.distance(solid.self, p), least, 1e-15);
        }
        filtration_bed_free(&bed);
    }
}

static void test_fibres(void **state) {
    (void)state;
    /* one fibre longer than the box, through its periodic faces, and one inside it */
    const double a[6] = {-5e-4, 1e-4, 1e-4, 1e-4, 5e-5, 2e-4}, b[6] = {8e-4, 1e-4, 1e-4, 1e-4, 5e-5, 3e-4},
                 radius[2] = {2e-5, 1e-5};
    const int periodic[3] = {1, 1, 0};
    filtration_bed bed;
    assert_int_equal(filtration_bed_init(&bed, 2, a, b, radius, box, periodic, 1e-4, NULL), FILTRATION_OK);
    const double beside[3] = {2e-4, 1.5e-4, 1e-4}, over_end[3] = {1e-4, 5e-5, 3.4e-4},
                 wrapped[3] = {1e-4 + 3e-4, 5e-5 + 3e-5 - 2e-4, 2.5e-4};
    near(filtration_bed_distance(&bed, beside), 3e-5, 1e-15);
    near(filtration_bed_distance(&bed, over_end), 3e-5, 1e-15);
    near(filtration_bed_distance(&bed, wrapped), 2e-5, 1e-15);
    filtration_bed_free(&bed);
    assert_int_equal(filtration_bed_init(&bed, 0, NULL, NULL, NULL, box, periodic, 1e-4, NULL), FILTRATION_OK);
    near(filtration_bed_distance(&bed, beside), 1e-4, 0.0);
    filtration_bed_free(&bed);
    filtration_bed_free(NULL);
}

static void test_cut(void **state) {
    (void)state;
    const double centre[3] = {1e-4, 1e-4, 1e-4}, radius = 3e-5;
    const int periodic[3] = {0, 0, 0};
    filtration_bed bed;
    assert_int_equal(filtration_bed_init(&bed, 1, centre, NULL, &radius, box, periodic, 1e-4, NULL), FILTRATION_OK);
    const filtration_solid solid = filtration_bed_solid(&bed);
    for (int trial = 0; trial < 300; trial++) { /* a link of 2.5 um across the surface: the root of a quadratic */
        double n[3], length = 0.0, out[3], in[3], along[3], b = 0.0, c = 0.0, square = 0.0;
        for (int k = 0; k < 3; k++) n[k] = uniform() - 0.5, length += n[k] * n[k];
        length = sqrt(length);
        const double share = 0.01 + 0.98 * uniform();
        for (int k = 0; k < 3; k++) {
            n[k] /= length;
            along[k] = -2.5 * um * (n[k] + 0.6 * (uniform() - 0.5));
            out[k] = centre[k] + radius * n[k] - share * along[k];
            in[k] = out[k] + along[k];
        }
        for (int k = 0; k < 3; k++)
            square += along[k] * along[k], b += along[k] * (out[k] - centre[k]),
                c += (out[k] - centre[k]) * (out[k] - centre[k]);
        if (c <= radius * radius || filtration_bed_distance(&bed, in) > 0.0) continue;
        const double q = (-b - sqrt(b * b - square * (c - radius * radius))) / square;
        near(filtration_solid_cut(&solid, out, in), q, 1e-8);
        assert_true(isnan(filtration_solid_cut(&solid, in, out)) && isnan(filtration_solid_cut(&solid, out, out)));
    }
    filtration_bed_free(&bed);
}

static void test_bed_without_memory(void **state) {
    (void)state;
    const double centre[6] = {1e-4, 1e-4, 1e-4, 2e-4, 1e-4, 3e-4}, radius[2] = {3e-5, 2e-5};
    const int periodic[3] = {1, 1, 1};
    for (int k = 0;; k++) {
        failing_allocator allocator;
        failing_init_at(&allocator, k);
        filtration_memory memory = {failing_fn, &allocator};
        filtration_bed bed;
        const filtration_status status =
            filtration_bed_init(&bed, 2, centre, NULL, radius, box, periodic, 1e-4, &memory);
        assert_int_equal(status, allocator.has_failed ? FILTRATION_NO_MEMORY : FILTRATION_OK);
        filtration_bed_free(&bed);
        assert_int_equal(failing_live(&allocator), 0);
        if (!allocator.has_failed) break;
    }
}

static void test_bad_bed(void **state) {
    (void)state;
    const int periodic[3] = {1, 0, 1};
    const double bad[] = {NAN, HUGE_VAL, -1.0, 0.0};
    filtration_bed bed;
    for (int i = 0; i < 4; i++) {
        double centre[3] = {1e-4, 1e-4, 1e-4}, radius = 1e-5, edges[3] = {1e-3, 1e-3, 1e-3};
        radius = bad[i];
        assert_int_equal(filtration_bed_init(&bed, 1, centre, NULL, &radius, edges, periodic, 1e-4, NULL),
                         FILTRATION_BAD_ARGUMENT);
        radius = 1e-5, edges[1] = bad[i];
        assert_int_equal(filtration_bed_init(&bed, 1, centre, NULL, &radius, edges, periodic, 1e-4, NULL),
                         FILTRATION_BAD_ARGUMENT);
        edges[1] = 1e-3;
        assert_int_equal(filtration_bed_init(&bed, 1, centre, NULL, &radius, edges, periodic, bad[i], NULL),
                         FILTRATION_BAD_ARGUMENT);
        centre[2] = i == 3 ? 1e300 : i == 2 ? (double)NAN : bad[i];
        assert_int_equal(filtration_bed_init(&bed, 1, centre, NULL, &radius, edges, periodic, 1e-4, NULL),
                         FILTRATION_BAD_ARGUMENT);
        filtration_bed_free(&bed);
    }
    assert_int_equal(filtration_bed_init(NULL, 0, NULL, NULL, NULL, box, periodic, 1, NULL), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_bed_init(&bed, 1, NULL, NULL, NULL, box, periodic, 1, NULL), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_bed_init(&bed, 0, NULL, NULL, NULL, NULL, periodic, 1, NULL), FILTRATION_BAD_ARGUMENT);
}

/* ---- images ---- */

static void test_image(void **state) {
    (void)state;
    unsigned char solid[4 * 5 * 6];
    memset(solid, 0, sizeof solid);
    solid[(2 * 5 + 1) * 4 + 3] = 255; /* one cube, at x 3, y 1, z 2 */
    filtration_image image = {{4, 5, 6}, 2 * um, {10 * um, 0.0, 0.0}, {0, 0, 0}, 4, NULL};
    image.solid = solid;
    assert_int_equal(filtration_image_check(&image), FILTRATION_OK);
    const double before[3] = {15 * um, 3 * um, 5 * um}, corner[3] = {15 * um, 1 * um, 3 * um},
                 in[3] = {16.5 * um, 3 * um, 5 * um};
    const double far_away[3] = {-1.0, 2.0, 3.0}, wrapped[3] = {11 * um, 3 * um, 5 * um};
    near(filtration_image_distance(&image, before), 1 * um, 1e-15);
    near(filtration_image_distance(&image, corner), sqrt(3.0) * um, 1e-15);
    near(filtration_image_distance(&image, in), -0.5 * um, 1e-15);
    assert_true(filtration_image_distance(&image, far_away) > 0.0);
    near(filtration_image_distance(&image, wrapped), 5 * um, 1e-15);
    image.periodic[0] = 1;
    near(filtration_image_distance(&image, wrapped), 1 * um, 1e-15);
    const filtration_solid s = filtration_image_solid(&image);
    const double from[3] = {15 * um, 3 * um, 5 * um}, to[3] = {17 * um, 3 * um, 5 * um};
    near(filtration_solid_cut(&s, from, to), 0.5, 1e-9);
    const double bad[] = {NAN, 0.0, -1.0, HUGE_VAL};
    for (int i = 0; i < 4; i++) {
        filtration_image wrong = image;
        wrong.edge = bad[i];
        assert_int_equal(filtration_image_check(&wrong), FILTRATION_BAD_ARGUMENT);
    }
    filtration_image wrong = image;
    wrong.n[1] = 0;
    assert_int_equal(filtration_image_check(&wrong), FILTRATION_BAD_ARGUMENT);
    wrong = image, wrong.solid = NULL;
    assert_int_equal(filtration_image_check(&wrong), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_image_check(NULL), FILTRATION_BAD_ARGUMENT);
}

/* A voxelled sphere: the image's distance never exceeds the brute force over all cubes, and its sign is the cube's. */
static void test_image_against_brute_force(void **state) {
    (void)state;
    enum { N = 12 };
    unsigned char solid[N * N * N];
    for (int i = 0; i < N * N * N; i++) {
        const double x = i % N - 5.5, y = i / N % N - 5.5, z = i / N / N - 5.5;
        solid[i] = x * x + y * y + z * z < 16.0;
    }
    filtration_image image = {{N, N, N}, 1.0, {0.0, 0.0, 0.0}, {1, 1, 1}, N, NULL};
    image.solid = solid;
    for (int trial = 0; trial < 200; trial++) {
        const double p[3] = {uniform() * N, uniform() * N, uniform() * N};
        const int own = solid[((int)p[2] * N + (int)p[1]) * N + (int)p[0]];
        double least = N;
        for (int i = 0; i < N * N * N; i++) {
            if (solid[i] == own) continue;
            const double c[3] = {i % N, i / N % N, i / N / N};
            double square = 0.0;
            for (int k = 0; k < 3; k++) {
                double a = p[k] - c[k] - 0.5;
                a = fabs(a - N * floor(a / N + 0.5)) - 0.5;
                if (a > 0.0) square += a * a;
            }
            least = fmin(least, sqrt(square));
        }
        near(filtration_image_distance(&image, p), own ? -least : least, 1e-12);
    }
}

/* A plate across an axis with a slot half as wide as `wide`, in the way of the flow. */
typedef struct plate {
    int axis, across;
    double low, high, middle, wide;
} plate;
static double plate_distance(const void *self, const double point[3]) {
    const plate *p = self;
    const double z = point[p->axis], x = fabs(point[p->across] - p->middle);
    return z > p->low && z < p->high && x > 0.5 * p->wide ? -1e-9 : 1e-9;
}

/* A jet from a slot, whose vortices reach the face behind it along or against an axis; returns how the run ended. */
static filtration_status run_jet(int face, filtration_face kind, int steps, double *backflow) {
    const int axis = face / 2, across = (axis + 1) % 3, long_side = 40, wide_side = 60;
    filtration_fluid_def def = filtration_fluid_default_def();
    filtration_fluid fluid;
    const double voxel = 1e-5, edge = face % 2 ? long_side - 16 : 12;
    const plate slot = {axis, across, edge * voxel, (edge + 4) * voxel, 0.5 * wide_side * voxel, 16.0 * voxel};
    def.voxel = voxel, def.tau = 0.515, def.magic = 0.03, def.bulk_ratio = 10.0, def.boundary = FILTRATION_HALF_WAY;
    def.nodes[axis] = long_side, def.nodes[across] = wide_side, def.nodes[(axis + 2) % 3] = 1;
    def.face[face] = kind, def.face[face ^ 1] = FILTRATION_INFLOW;
    def.face_velocity[face ^ 1][axis] = face % 2 ? 0.4 : -0.4;
    def.solid.distance = plate_distance, def.solid.self = &slot;
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    const filtration_status status = filtration_fluid_run(&fluid, steps, NULL);
    *backflow = 0.0;
    for (int x = 0; x < wide_side; x++) {
        filtration_sample sample;
        int at[3] = {0, 0, 0};
        at[axis] = face % 2 ? long_side - 1 : 0, at[across] = x;
        assert_int_equal(filtration_fluid_at(&fluid, at[0], at[1], at[2], &sample), FILTRATION_OK);
        *backflow = fmax(*backflow, face % 2 ? -sample.velocity[axis] : sample.velocity[axis]);
    }
    filtration_fluid_free(&fluid);
    return status;
}

/* Vortices leave through an outlet; at a face of given pressure what they bring back feeds itself until the
   run diverges. */
static void test_vortices_leave(void **state) {
    double backflow;
    (void)state;
    for (int face = 1; face < 6; face += 3) {
        assert_int_equal(run_jet(face, FILTRATION_OUTLET, 2500, &backflow), FILTRATION_OK);
        assert_true(backflow < 0.5); /* its mean goes out with 0.4 */
        assert_int_equal(run_jet(face, FILTRATION_PRESSURE, 2500, &backflow), FILTRATION_DIVERGED);
        assert_true(backflow > 4.0);
    }
}

/* What comes in through an outlet has the energy of a vessel at rest: its pressure is less by rho u^2 / 2; what goes
   has the given one. */
static void test_outlet_by_bernoulli(void **state) {
    (void)state;
    for (int face = 0; face < 6; face++)
        for (int comes = 0; comes < 2; comes++) {
            filtration_fluid_def def = filtration_fluid_default_def();
            filtration_fluid fluid;
            filtration_sample sample;
            const double inward = face % 2 ? -1.0 : 1.0, speed = 0.2;
            def.voxel = 1e-5, def.tau = 0.6, def.bulk_ratio = 10.0;
            def.nodes[0] = def.nodes[1] = def.nodes[2] = 2, def.nodes[face / 2] = 16;
            def.face[face] = FILTRATION_OUTLET, def.face_pressure[face] = 100.0, def.face[face ^ 1] = FILTRATION_INFLOW;
            def.face_velocity[face ^ 1][face / 2] = comes ? inward * speed : -inward * speed;
            assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
            assert_int_equal(filtration_fluid_run(&fluid, 4000, NULL), FILTRATION_OK);
            assert_int_equal(
                filtration_fluid_at(&fluid, face / 2 ? 0 : 8, face / 2 == 1 ? 8 : 0, face / 2 == 2 ? 8 : 0, &sample),
                FILTRATION_OK);
            const double expected = comes ? 100.0 - 0.5 * 1000.0 * speed * speed : 100.0;
            near(sample.pressure, expected, comes ? 0.1 : 1e-6);
            filtration_fluid_free(&fluid);
        }
}

/* A channel with an even inflow and a given pressure at its end, along each axis: all of the inflow arrives, as
   the parabola. */
static void test_channel_with_inflow(void **state) {
    (void)state;
    for (int axis = 0; axis < 3; axis++) {
        const int across = (axis + 1) % 3, length = 48, width = 12;
        filtration_fluid_def def = filtration_fluid_default_def();
        filtration_fluid fluid;
        const double inflow = 1e-3, voxel = 1e-5;
        def.voxel = voxel, def.tau = 1.0, def.nodes[0] = def.nodes[1] = def.nodes[2] = 2;
        def.nodes[axis] = length, def.nodes[across] = width;
        def.face[2 * across] = def.face[2 * across + 1] = FILTRATION_WALL;
        def.face[2 * axis + 1] = FILTRATION_PRESSURE, def.face_pressure[2 * axis + 1] = 0.1;
        def.face[2 * axis] = FILTRATION_INFLOW, def.face_velocity[2 * axis][axis] = inflow;
        assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
        assert_int_equal(filtration_fluid_run(&fluid, 6000, NULL), FILTRATION_OK);
        for (int slab = 0; slab + 1 < length;
             slab++) { /* of two slabs: a wave of two nodes, 1e-4 of the flow, stays between the faces */
            const double flow =
                0.5 * (filtration_fluid_flux(&fluid, axis, slab) + filtration_fluid_flux(&fluid, axis, slab + 1));
            assert_true(fabs(flow / inflow - 1.0) < 1e-5);
        }
        for (int i = 0; i < width; i++) {
            int at[3] = {0, 0, 0};
            filtration_sample sample;
            at[axis] = 3 * length / 4, at[across] = i;
            assert_int_equal(filtration_fluid_at(&fluid, at[0], at[1], at[2], &sample), FILTRATION_OK);
            const double y = (i + 0.5) / width, parabola = 6.0 * inflow * y * (1.0 - y);
            assert_true(fabs(sample.velocity[axis] - parabola) < 0.01 * inflow);
            if (i == width / 2)
                assert_true(
                    fabs(sample.pressure - 0.1 - 12.0 * 1e-3 * inflow * 11.5 * voxel / (144.0 * voxel * voxel)) < 0.01);
        }
        const double velocity[3] = {0.0, 0.0, 0.0}; /* it can be stopped; a wall lets nothing through */
        assert_int_equal(filtration_fluid_set_face_velocity(&fluid, 2 * axis, velocity), FILTRATION_OK);
        assert_int_equal(filtration_fluid_run(&fluid, 3000, NULL), FILTRATION_OK);
        const double rest =
            filtration_fluid_flux(&fluid, axis, length / 2) + filtration_fluid_flux(&fluid, axis, length / 2 + 1);
        assert_true(fabs(rest) < 2e-4 * inflow);
        filtration_fluid_free(&fluid);
        def.face[2 * axis] = FILTRATION_WALL;
        assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_BAD_DEF);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cloth_numbers),
        cmocka_unit_test(test_cloth_crossings),
        cmocka_unit_test(test_cloth_against_brute_force),
        cmocka_unit_test(test_cloth_repeats_and_is_open),
        cmocka_unit_test(test_bad_cloth),
        cmocka_unit_test(test_spheres),
        cmocka_unit_test(test_fibres),
        cmocka_unit_test(test_cut),
        cmocka_unit_test(test_bed_without_memory),
        cmocka_unit_test(test_bad_bed),
        cmocka_unit_test(test_image),
        cmocka_unit_test(test_image_against_brute_force),
        cmocka_unit_test(test_vortices_leave),
        cmocka_unit_test(test_outlet_by_bernoulli),
        cmocka_unit_test(test_channel_with_inflow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
