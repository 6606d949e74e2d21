/* Bodies in gas: sphericities of polyhedra and clumps along a flow, and drag by them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "dem.h"

#include "../examples/common/random.h"
#include "failing_allocator.h"
#include "near.h"

DEM_GAS(hoelzer, dem_drag_hoelzer_sommerfeld)

static const double eta = 1.81e-5, air_density = 1.2, density = 2700.0;

static dem_world empty(double dt, int threads) {
    dem_world w;
    dem_def def = dem_default_def();
    dem_add_material(&def, density, 1e9, 0.3);
    dem_pair(&def, 0, 0)->stiffness = 200.0;
    dem_pair(&def, 0, 0)->restitution = 0.5;
    def.dt = dt, def.threads = threads, def.gravity = dem_vec3(0, 0, 0);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    return w;
}
static void add_shape(dem_world *w, const dem_convex *shape, dem_vec x, const double *turn) {
    const double at[3] = {x.x, x.y, x.z};
    const int number = dem_add_shape(w, shape);
    assert_true(number >= 0);
    assert_int_equal(dem_add_convex(w, number, 1, at, turn, 0, 0), DEM_OK);
}

/* A cube: the sphere's circle over its face, its corner view, and (3 - 4/pi) faces; however it lies, is sized or
   rounded. */
static void cube(void **state) {
    (void)state;
    const double circle = RIDDLE_PI / 4.0 * pow(6.0 / RIDDLE_PI, 2.0 / 3.0), tilt = sqrt(0.5);
    const double turn[2][4] = {{1, 0, 0, 0}, {cos(0.4), 0, sin(0.4), 0}};
    for (int trial = 0; trial < 6; trial++) {
        const double a = trial % 3 == 0 ? 1e-4 : trial % 3 == 1 ? 1e-2 : 3.0, angle = trial < 3 ? 0.0 : 0.8;
        dem_convex box;
        double psi[3];
        dem_world w = empty(1e-5, 1);
        assert_int_equal(dem_make_brick(&box, dem_vec3(a, a, a), trial % 2 ? 0.2 : 0.01, NULL), DEM_OK);
        add_shape(&w, &box, dem_vec3(0, 0, 0), turn[trial / 3]);
        const dem_vec face = dem_vec3(sin(angle), 0, cos(angle)), side = dem_vec3(cos(angle), 0, -sin(angle));
        assert_int_equal(dem_body_sphericities(&w, 0, dem__scale(7.0, face), psi), DEM_OK);
        near(psi[0], circle * 4.0 / 6.0, 1e-12), near(psi[1], circle, 1e-12),
            near(psi[2], circle / (3.0 - 4.0 / RIDDLE_PI), 1e-12);
        const dem_vec corner = dem__add(dem__add(face, side), dem_vec3(0, 1, 0));
        assert_int_equal(dem_body_sphericities(&w, 0, corner, psi), DEM_OK);
        near(psi[1], circle / sqrt(3.0), 1e-12);
        near(psi[2], circle / (3.0 - 6.0 / RIDDLE_PI * sqrt(2.0 / 3.0)), 1e-12);
        assert_int_equal(dem_body_sphericities(&w, 0, dem__plus(dem__scale(tilt, side), -tilt, face), psi), DEM_OK);
        near(psi[1], circle / sqrt(2.0), 1e-12);
        dem_free(&w);
    }
}

/* A disc of 16 sides, seen on its face and on its edge, and a needle of a brick. */
static void disc_and_needle(void **state) {
    (void)state;
    const double d = 4e-3, h = 3e-4, face = RIDDLE_PI / 4.0 * d * d, x = cbrt(1.5 * d * d * h),
                 r = d * sqrt(RIDDLE_PI / (32.0 * sin(RIDDLE_PI / 8.0))), rim = 32.0 * r * sin(RIDDLE_PI / 16.0) * h;
    const double surface = 2.0 * face + rim, circle = RIDDLE_PI / 4.0 * x * x;
    dem_convex disc, needle;
    double psi[3], mean = 0.0;
    dem_world w = empty(1e-5, 1);
    assert_int_equal(dem_make_tablet(&disc, d, h, h, 0.03, NULL), DEM_OK);
    assert_int_equal(dem_make_brick(&needle, dem_vec3(1e-4, 2e-4, 5e-3), 0.03, NULL), DEM_OK);
    add_shape(&w, &disc, dem_vec3(0, 0, 0), NULL), add_shape(&w, &needle, dem_vec3(1, 0, 0), NULL);
    assert_int_equal(dem_body_sphericities(&w, 0, dem_vec3(0, 0, -1), psi), DEM_OK);
    close_to(psi[0], RIDDLE_PI * x * x / surface, 1e-9), close_to(psi[1], circle / face, 1e-9);
    close_to(psi[2], circle / (0.5 * surface - rim / RIDDLE_PI), 1e-9);
    for (int k = 0; k < 1024; k++) { /* the mean over the 16-gon's widths is its perimeter/pi */
        const double angle = 2.0 * RIDDLE_PI * (k + 0.5) / 1024.0;
        assert_int_equal(dem_body_sphericities(&w, 0, dem_vec3(cos(angle), sin(angle), 0), psi), DEM_OK);
        mean += circle / psi[1] / 1024.0;
    }
    close_to(mean, rim / RIDDLE_PI, 1e-5);
    const double needle_circle = RIDDLE_PI / 4.0 * pow(6.0 / RIDDLE_PI * 1e-10, 2.0 / 3.0);
    assert_int_equal(dem_body_sphericities(&w, 1, dem_vec3(0, 0, 1), psi), DEM_OK);
    close_to(psi[0], 4.0 * needle_circle / 3.04e-6, 1e-9), close_to(psi[1], needle_circle / 2e-8, 1e-9);
    close_to(psi[2], needle_circle / (1.52e-6 - 3e-6 / RIDDLE_PI), 1e-9);
    assert_int_equal(dem_body_sphericities(&w, 1, dem_vec3(0, 0, 0), psi), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_body_sphericities(&w, 1, dem_vec3(0, NAN, 1), psi), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_body_sphericities(&w, 2, dem_vec3(0, 0, 1), psi), DEM_BAD_ARGUMENT);
    dem_free(&w);
}

/* Bricks whose edges have any order, turned or not: each face shows its area. */
static void bricks(void **state) {
    (void)state;
    static const int order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
    const double edge[3] = {1e-3, 2e-3, 3.5e-3}, circle = RIDDLE_PI / 4.0 * pow(6.0 / RIDDLE_PI * 7e-9, 2.0 / 3.0);
    const double turn[4] = {sqrt(0.5), 0, 0, sqrt(0.5)}; /* x to y, y to -x */
    for (int trial = 0; trial < 12; trial++) {
        const int *o = order[trial / 2];
        const double a[3] = {edge[o[0]], edge[o[1]], edge[o[2]]}, s = a[0] * a[1] + a[1] * a[2] + a[2] * a[0];
        dem_convex brick;
        dem_world w = empty(1e-5, 1);
        double psi[3];
        assert_int_equal(dem_make_brick(&brick, dem_vec3(a[0], a[1], a[2]), 0.03, NULL), DEM_OK);
        add_shape(&w, &brick, dem_vec3(0, 0, 0), trial % 2 ? turn : NULL);
        for (int k = 0; k < 3; k++) {
            const int world = trial % 2 && k < 2 ? 1 - k : k;
            const dem_vec flow = dem_vec3(world == 0, world == 1, world == 2);
            const double face = a[(k + 1) % 3] * a[(k + 2) % 3];
            assert_int_equal(dem_body_sphericities(&w, 0, flow, psi), DEM_OK);
            close_to(psi[0], 4.0 * circle / (2.0 * s), 1e-11), close_to(psi[1], circle / face, 1e-11);
            close_to(psi[2], circle / (s - 2.0 * (s - face) / RIDDLE_PI), 1e-11);
        }
        dem_free(&w);
    }
}

static void add_clump(dem_world *w, int n, const double *centre, const double *width, double d, dem_vec x,
                      const double *turn) {
    dem_clump c;
    const double at[3] = {x.x, x.y, x.z};
    assert_int_equal(dem_make_clump(n, centre, width, &c), DEM_OK);
    assert_int_equal(dem_add_clumps(w, 1, &c, at, d > 0.0 ? &d : NULL, turn, 0, 0), DEM_OK);
}

/* Two balls that touch, two that overlap, end-on and side-on; three in a triangle; a ball alone. */
static void clumps(void **state) {
    (void)state;
    const double two[6] = {0, 0, -0.5, 0, 0, 0.5}, ones[3] = {1, 1, 1}, lens[6] = {0, 0, -0.3, 0, 0, 0.3};
    const double three[9] = {0, 0, 0, 1, 0, 0, 0.5, sqrt(0.75), 0};
    double psi[3];
    dem_world w = empty(1e-5, 1);
    add_clump(&w, 2, two, ones, 0.0, dem_vec3(0, 0, 0), NULL),
        add_clump(&w, 2, lens, ones, 1e-3, dem_vec3(0, 3, 0), NULL);
    add_clump(&w, 3, three, ones, 0.02, dem_vec3(9, 0, 0), NULL),
        add_clump(&w, 1, two, ones, 0.1, dem_vec3(12, 0, 0), NULL);
    const double x2 = pow(2.0, 2.0 / 3.0);
    assert_int_equal(dem_body_sphericities(&w, 0, dem_vec3(0, 0, 1), psi), DEM_OK);
    near(psi[0], x2 / 2.0, 1e-8), near(psi[1], x2, 1e-8), near(psi[2], x2 / (4.0 - 2.0), 1e-7);
    assert_int_equal(dem_body_sphericities(&w, 0, dem_vec3(0, 1, 0), psi), DEM_OK);
    near(psi[1], x2 / 2.0, 1e-8);
    /* caps of 0.2 are cut off: volume, surface, the outline of two circles */
    const double cap = RIDDLE_PI * 0.04 * (1.5 - 0.2) / 3.0, volume = 2.0 * (RIDDLE_PI / 6.0 - cap),
                 x = cbrt(6.0 / RIDDLE_PI * volume);
    const double surface = 2.0 * (RIDDLE_PI - RIDDLE_PI * 0.2), half = acos(0.6), slice = 0.25 * (half - 0.6 * 0.8);
    const ptrdiff_t second = 2;
    assert_int_equal(dem_body_sphericities(&w, second, dem_vec3(1, 0, 0), psi), DEM_OK);
    near(psi[0], RIDDLE_PI * x * x / surface, 1e-8),
        near(psi[1], RIDDLE_PI / 4.0 * x * x / (RIDDLE_PI / 2.0 - 2.0 * slice), 1e-8);
    assert_int_equal(dem_body_sphericities(&w, second, dem_vec3(0, 0, -4), psi), DEM_OK);
    near(psi[1], x * x, 1e-8);
    near(psi[2], RIDDLE_PI / 4.0 * x * x / (0.5 * surface - RIDDLE_PI / 2.0 + 2.0 * slice), 1e-8);
    assert_int_equal(dem_body_sphericities(&w, 4, dem_vec3(0, 0, 1), psi), DEM_OK); /* face-on: three circles */
    near(psi[1], pow(3.0, 2.0 / 3.0) / 3.0, 1e-8);
    assert_int_equal(dem_body_sphericities(&w, 7, dem_vec3(1, 2, 3), psi), DEM_OK);
    assert_true(psi[0] == 1.0 && psi[1] == 1.0 && psi[2] == 1.0);
    dem_free(&w);
}

/* A law that notes what it is told of a body, and pushes along. */
typedef struct note {
    dem_vec flow;
    double psi[3];
} note;
static dem_vec noting(const dem_force_point *at) {
    note *n = *(note *const *)at->user;
    dem_sphericities(at, n->flow, n->psi);
    return dem_vec3(1e-9, 0, 0);
}
DEM_FORCE_FIELD(noting_field, noting)

/* In flight a law reads a clump's areas from a table: close to the exact ones, in any direction. */
static void table(void **state) {
    (void)state;
    double centre[60], width[20], worst[3] = {0, 0, 0}, psi[3];
    uint64_t random = 11;
    for (int shape = 0; shape < 4; shape++) {
        const int n = shape == 0 ? 2 : shape == 1 ? 7 : 20;
        for (int k = 0; k < n; k++) {
            width[k] = shape == 2 ? 1.0 + random_plain(&random) : 1.0;
            for (int a = 0; a < 3; a++)
                centre[3 * k + a] = shape < 2 ? (a == 0 ? 0.6 * k : 0.0) : 2.0 * random_plain(&random);
        }
        dem_world w = empty(1e-6, 1);
        note n_of, *user = &n_of;
        dem_force_field f = dem_default_force_field(noting_field, &user);
        add_clump(&w, n, centre, width, 1e-3, dem_vec3(0, 0, 0), NULL);
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        for (int k = 0; k < 40; k++) {
            n_of.flow = dem_vec3(random_plain(&random) - 0.5, random_plain(&random) - 0.5, random_plain(&random) - 0.5);
            assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 0)), DEM_OK);
            assert_int_equal(dem_run(&w, 2e-6, DEM_LINEAR | DEM_FRICTION), DEM_OK);
            assert_int_equal(dem_body_sphericities(&w, 0, n_of.flow, psi), DEM_OK);
            for (int a = 0; a < 3; a++) worst[a] = fmax(worst[a], fabs(n_of.psi[a] / psi[a] - 1.0));
        }
        dem_free(&w);
    }
    if (getenv("SAY")) printf("table off by %.2g %.2g %.2g\n", worst[0], worst[1], worst[2]);
    assert_true(worst[0] < 1e-12 && worst[1] < 0.02 && worst[2] < 0.01);
}

/* Hoelzer & Sommerfeld's c_D Re, written out. */
static double law_of(double re, double psi, double crosswise, double lengthwise) {
    return 8.0 / sqrt(lengthwise) + 16.0 / sqrt(psi) + 3.0 * sqrt(re) / pow(psi, 0.75) +
           0.42 * re * pow(10.0, 0.4 * pow(-log10(psi), 0.2)) / crosswise;
}
/* Returns the force on a body at rest in gas that comes with a velocity, from the speed that it gets. */
static dem_vec force_on(dem_world *w, dem_field_fn kernel, dem_gas *air, dem_vec wind) {
    air->drift = wind;
    dem_force_field f = dem_gas_field(kernel, air);
    assert_int_equal(dem_check_gas(air, NULL), DEM_OK);
    assert_int_equal(dem_set_force_field(w, &f), DEM_OK);
    assert_int_equal(dem_set_motion(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 0)), DEM_OK);
    const double from = w->time;
    assert_int_equal(dem_run(w, 2.0 * w->def.dt, DEM_LINEAR | DEM_FRICTION), DEM_OK);
    return dem__scale(dem_mass(w, 0) / (w->time - from), dem_velocity(w, 0));
}
DEM_INLINE double mine(double reynolds, double porosity, const dem_gas *gas) {
    double psi[3];
    (void)porosity;
    dem_gas_sphericities(gas, psi);
    return 100.0 * psi[0] + 10.0 * psi[1] + psi[2] + 0.0 * reynolds;
}
DEM_GAS(my_drag, mine)

/* The force on a cube, a disc and two balls, from slow to fast, on the face and on the edge; by sphericity; shared;
   a user's law. */
static void forces(void **state) {
    (void)state;
    const double two[6] = {0, 0, -0.5, 0, 0, 0.5}, ones[2] = {1, 1}, d = 1e-3;
    for (int trial = 0; trial < 32; trial++) {
        const int kind = trial % 4, fast = trial / 4 % 4, edge = trial / 16;
        const double speed = fast == 0 ? 1e-10 : fast == 1 ? 1e-3 : fast == 2 ? 1.0 : 30.0;
        dem_world w = empty(1e-9, 1);
        dem_convex shape;
        dem_gas air = dem_default_gas();
        double psi[3];
        if (kind == 0) assert_int_equal(dem_make_brick(&shape, dem_vec3(d, d, d), 0.05, NULL), DEM_OK);
        if (kind == 1) assert_int_equal(dem_make_tablet(&shape, 2.0 * d, 0.3 * d, 0.3 * d, 0.05, NULL), DEM_OK);
        if (kind == 3) assert_int_equal(dem_make_brick(&shape, dem_vec3(3.0 * d, d, 0.5 * d), 0.05, NULL), DEM_OK);
        if (kind == 2) add_clump(&w, 2, two, ones, d, dem_vec3(0, 0, 0), NULL);
        else add_shape(&w, &shape, dem_vec3(0, 0, 0), NULL);
        const dem_vec wind = edge ? dem_vec3(0.6 * speed, 0.8 * speed, 0) : dem_vec3(0, 0, -speed);
        assert_int_equal(dem_body_sphericities(&w, 0, wind, psi), DEM_OK);
        const double x = cbrt(6.0 / RIDDLE_PI * dem_mass(&w, 0) / density), re = air_density * speed * x / eta;
        dem_vec f = force_on(&w, hoelzer, &air, wind);
        const double unit = RIDDLE_PI / 8.0 * eta * x * speed, along = dem__dot(f, wind) / speed;
        close_to(along, unit * law_of(re, psi[0], psi[1], psi[2]), kind == 2 && edge ? 0.02 : 1e-5);
        if (fast == 0)
            close_to(along, unit * (8.0 / sqrt(psi[2]) + 16.0 / sqrt(psi[0])),
                     kind == 2 && edge ? 0.02 : 2e-5);                               /* Stokes */
        assert_true(dem__length(dem__plus(f, -along / speed, wind)) < 1e-9 * along); /* nothing across */
        air.bodies = DEM_DRAG_BY_SPHERICITY, f = force_on(&w, hoelzer, &air, wind);
        close_to(dem__length(f), unit * law_of(re, psi[0], psi[0], psi[0]), 1e-5);
        f = force_on(&w, my_drag, &air, wind);
        close_to(dem__length(f), unit * 111.0 * psi[0], 1e-5);
        air.bodies = DEM_DRAG_SHARED, f = force_on(&w, hoelzer, &air, wind);
        close_to(dem__length(f), unit * (24.0 + 3.0 * sqrt(re) + 0.42 * re), 1e-5);
        f = force_on(&w, my_drag, &air, wind);
        close_to(dem__length(f), unit * 111.0, 1e-5);
        air.bodies = 3;
        assert_int_equal(dem_check_gas(&air, NULL), DEM_BAD_DEFINITION);
        dem_free(&w);
    }
}

/* Adds bodies of every kind, in either order, each turning and flying; with three different moments, too. */
static void add_crowd(dem_world *w, int backwards) {
    const double two[6] = {0, 0, -0.5, 0, 0, 0.5}, wide[3] = {1, 0.7, 0.5},
                 bent[9] = {0, 0, 0, 0.6, 0, 0, 0.8, 0.5, 0.1};
    dem_convex brick, disc;
    assert_int_equal(dem_make_brick(&brick, dem_vec3(3e-4, 1e-4, 2e-4), 0.03, NULL), DEM_OK);
    assert_int_equal(dem_make_tablet(&disc, 3e-4, 6e-5, 6e-5, 0.03, NULL), DEM_OK);
    const int shape[2] = {dem_add_shape(w, &brick), dem_add_shape(w, &disc)};
    for (int q = 0; q < 40; q++) {
        const int k = backwards ? 39 - q : q;
        uint64_t random = 77 + 13 * (uint64_t)k;
        double v[10], at[3] = {1e-3 * (k % 8), 1e-3 * (k / 8), 0.0};
        for (int a = 0; a < 10; a++) v[a] = 2.0 * random_plain(&random) - 1.0;
        const dem_vec x = dem_vec3(at[0], at[1], at[2]);
        if (k % 4 < 2) assert_int_equal(dem_add_convex(w, shape[k % 4], 1, at, v, 0, 0), DEM_OK);
        else if (k % 4 == 2) add_clump(w, 2, two, wide, 2e-4 + 1e-6 * k, x, v);
        else add_clump(w, 3, bent, wide, 2e-4 + 1e-6 * k, x, v);
        const ptrdiff_t last = w->count - 1;
        assert_int_equal(
            dem_set_motion(w, last, dem_vec3(v[4], v[5], v[6]), dem_vec3(2e3 * v[7], 2e3 * v[8], 2e3 * v[9])), DEM_OK);
    }
}

/* Threads, pieces of a run, a save, and the order in which bodies came change no bit; small steps of flight change
   little, and the work of the field is what the bodies lose. */
static void same_bits(void **state) {
    (void)state;
    dem_vec x[7][40];
    for (int run = 0; run < 7; run++) {
        dem_world w = empty(1e-6, run == 1 ? 5 : run == 5 ? 2 : 1);
        dem_gas air = dem_default_gas();
        dem_force_field f = dem_gas_field(hoelzer, &air);
        w.def.skip = run == 6 ? 0 : DEM_SKIP_ALL;
        if (run == 4) f.interval = 2e-6;
        add_crowd(&w, run == 3);
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        for (int k = 0; k < (run == 2 ? 10 : 1); k++) {
            assert_int_equal(
                dem_run(&w, run == 2 ? 4e-4 : 4e-3, DEM_LINEAR | DEM_FRICTION | (run == 5 ? DEM_ENERGY : 0)), DEM_OK);
            if (k != 5) continue;
            const size_t size = dem_save(&w, NULL, 0);
            void *bytes = malloc(size);
            dem_world again;
            assert_non_null(bytes);
            assert_int_equal(dem_save(&w, bytes, size), size);
            assert_int_equal(dem_load(&again, bytes, size, NULL), DEM_OK);
            dem_free(&w), free(bytes);
            w = again;
            assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        }
        ptrdiff_t i = 0;
        for (int q = 0; q < 40; q++, i++) {
            const dem_body b = dem_get_body(&w, i);
            x[run][run == 3 ? 39 - q : q] = b.position;
            i += b.pieces - 1;
        }
        if (run == 5) {
            const dem_energy_ledger e = dem_energy(&w);
            if (getenv("SAY")) printf("field work %.3g error %.3g\n", e.field_work, e.error);
            assert_true(e.field_work < 0.0 && fabs(e.error) < 1e-4 * fabs(e.field_work));
        }
        dem_free(&w);
    }
    double far = 0.0;
    for (int run = 1; run < 7; run++) {
        for (int k = 0; k < 40; k++) {
            const double off = dem__length(dem__sub(x[run][k], x[0][k]));
            if (run == 4) far = fmax(far, off / 1e-4);
            else if (off != 0.0) fail_msg("run %d body %d off by %g", run, k, off);
        }
    }
    if (getenv("SAY")) printf("small steps: off by %.2g radii\n", far);
    assert_true(far < 1e-4);
}

/* A disc falls slower on its face than on its edge, a needle slower crosswise; a spin of 374 1/s decays. */
static void fall_and_spin(void **state) {
    (void)state;
    double z[2];
    for (int edge = 0; edge < 2; edge++) {
        const double turn[4] = {sqrt(0.5), edge ? sqrt(0.5) : 0.0, 0, edge ? 0.0 : sqrt(0.5)};
        dem_world w = empty(1e-5, 1);
        dem_convex disc;
        dem_gas air = dem_default_gas();
        dem_force_field f = dem_gas_field(hoelzer, &air);
        w.def.gravity = dem_vec3(0, 0, -9.81);
        assert_int_equal(dem_make_tablet(&disc, 2e-3, 2e-4, 2e-4, 0.05, NULL), DEM_OK);
        add_shape(&w, &disc, dem_vec3(0, 0, 0), turn);
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        assert_int_equal(dem_run(&w, 1.0, DEM_LINEAR | DEM_FRICTION), DEM_OK);
        z[edge] = dem_velocity(&w, 0).z;
        assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 374.0)), DEM_OK);
        assert_int_equal(dem_run(&w, 0.2, DEM_LINEAR | DEM_FRICTION), DEM_OK);
        const double spin = dem__length(dem_spin(&w, 0));
        assert_true(spin > 10.0 && spin < 370.0);
        dem_free(&w);
    }
    assert_true(z[1] < 1.3 * z[0] && z[0] < 0.0);
}

/* Measures and the records of exits tell the velocity of a body in flight as accurately as that of a sphere. */
static void same_velocity(void **state) {
    (void)state;
    const double centre[3] = {0, 0, 0}, d = 1e-3;
    const dem_vec x = dem_vec3(0.01, 0, 0), low = dem_vec3(0.005, -1, -1), high = dem_vec3(0.02, 1, 1);
    dem_world w = empty(1e-5, 1);
    dem_gas air = dem_default_gas();
    dem_force_field f = dem_gas_field(hoelzer, &air);
    dem_region sides[2] = {dem_box_region(dem_vec3(-0.005, -1, -1), dem_vec3(0.005, 1, 1)), dem_box_region(low, high)};
    dem_measure m[2];
    dem_passed p[2];
    w.def.gravity = dem_vec3(0, 0, -9.81);
    assert_true(dem_add_exit(&w, dem_vec3(0, 0, -0.03), dem_vec3(0, 0, 1)) >= 0);
    assert_int_equal(dem_add_spheres(&w, 1, centre, &d, 0, 0), DEM_OK);
    add_clump(&w, 1, centre, &d, 0.0, x, NULL);
    assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
    assert_int_equal(dem_run(&w, 0.04321, DEM_LINEAR), DEM_OK);
    for (int k = 0; k < 2; k++) assert_int_equal(dem_measure_region(&w, &sides[k], &m[k]), DEM_OK);
    close_to(m[0].velocity.z, dem_velocity(&w, 0).z, 0.0), close_to(m[1].velocity.z, m[0].velocity.z, 1e-13);
    assert_int_equal(dem_run(&w, 0.1, DEM_LINEAR), DEM_OK);
    assert_int_equal(dem_take_passed(&w, p, 2), 2);
    close_to(p[1].velocity.z, p[0].velocity.z, 1e-13);
    dem_free(&w);
}

/* Memory that ends while shapes are looked at: a status, and a world that goes on. */
static void short_of_memory(void **state) {
    (void)state;
    int failed = 0;
    for (int at = 0; at < 60; at++) {
        failing_allocator memory;
        failing_init_at(&memory, at);
        dem_world w;
        dem_gas air = dem_default_gas();
        dem_force_field f = dem_gas_field(hoelzer, &air);
        dem_def def = dem_default_def();
        dem_clump pair;
        const double two[6] = {0, 0, -0.5, 0, 0, 0.5}, ones[2] = {1, 1}, centre[3] = {0, 0, 0};
        assert_int_equal(dem_make_clump(2, two, ones, &pair), DEM_OK);
        dem_add_material(&def, density, 1e9, 0.3);
        def.dt = 1e-6, def.allocator.fn = failing_fn, def.allocator.user = &memory;
        dem_status status = dem_init(&w, &def, NULL);
        if (status == DEM_OK) status = dem_set_force_field(&w, &f);
        if (status == DEM_OK) status = dem_add_clumps(&w, 1, &pair, centre, NULL, NULL, 0, 0);
        if (status == DEM_OK) status = dem_run(&w, 1e-5, DEM_LINEAR | DEM_FRICTION);
        if (status == DEM_OUT_OF_MEMORY) failed++;
        else assert_int_equal(status, DEM_OK);
        dem_free(&w);
        assert_int_equal(failing_live(&memory), 0);
        assert_int_equal(memory.misused, 0);
    }
    assert_true(failed > 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cube),           cmocka_unit_test(bricks),        cmocka_unit_test(disc_and_needle),
        cmocka_unit_test(clumps),         cmocka_unit_test(table),         cmocka_unit_test(forces),
        cmocka_unit_test(same_bits),      cmocka_unit_test(fall_and_spin), cmocka_unit_test(same_velocity),
        cmocka_unit_test(short_of_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
