/* Polyhedra that hit fast or soft: nothing passes a surface that it has been in front of, what is deep is told, and
   depth counts from the outside however deep it is. Bodies in each other come apart. Long: RIDDLE_LONG=1
   tests/test_dem_through, as scripts/verify does. */
#include "dem.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "near.h"
#include "../examples/common/random.h"

static uint64_t seed = 1;
static double uniform(double low, double high) { return low + (high - low) * random_plain(&seed); }
static int is_long(void) { return getenv("RIDDLE_LONG") != NULL; }
static void run(dem_world *w, double duration) {
    assert_int_equal(dem_run(w, duration, DEM_LINEAR | DEM_FRICTION), DEM_OK);
}

/* ---- bodies and walls ---- */

enum { CUBE, TETRAHEDRON, TABLET, ROD, ROCK, BODIES };
static const char *const body_name[BODIES] = {"cube", "tetrahedron", "tablet", "rod", "rock"};
static dem_convex shape_of(int body) {
    static const double tetrahedron[12] = {1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1};
    static const double rock[24] = {1,   0, 0,   -1,   0.1, 0,     0,   0.8, 0.1, 0,    -0.9, -0.1,
                                    0.1, 0, 0.7, -0.1, 0.1, -0.75, 0.6, 0.6, 0.3, -0.5, -0.5, 0.4};
    double corner[48];
    int n = body == TABLET ? 16 : body == ROCK ? 8 : 4;
    dem_convex s;
    for (int k = 0; k < 3 * n; k++) {
        const double at = 2.0 * RIDDLE_PI * (k / 3 % 8) / 8.0;
        corner[k] = body == TETRAHEDRON ? 0.012 * tetrahedron[k]
                    : body == ROCK      ? 0.02 * rock[k]
                    : k % 3 == 2        ? (k < 24 ? 5e-3 : -5e-3)
                                        : 0.02 * (k % 3 ? sin(at) : cos(at));
    }
    if (body == CUBE || body == ROD)
        assert_int_equal(dem_make_brick(&s, dem_vec3(body == ROD ? 0.08 : 0.02, 0.02, 0.02), 0.03, NULL), DEM_OK);
    else assert_int_equal(dem_make_convex(&s, n, corner, 0.03, NULL), DEM_OK);
    return s;
}

enum { PLANE, MESH, BOX, CONE, TUBE, CYLINDER, DISC, SCREEN, RIM, RIDGE, VALLEY, WALLS };
static const char *const wall_name[WALLS] = {"plane", "mesh",   "box", "cone",  "tube",  "cylinder",
                                             "disc",  "screen", "rim", "ridge", "valley"};
static void add_mesh(dem_world *w, int vertices, double *vertex, int triangles, int32_t *corner) {
    dem_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.vertices = vertices, mesh.vertex = vertex, mesh.triangles = triangles, mesh.triangle = corner;
    assert_true(dem_add_mesh(w, 0, &mesh) >= 0);
}
/* Adds a wall whose surface is touched at the origin, from above; a cone 6 mm under (0.1, 0, -0.05). */
static void add_wall(dem_world *w, int wall) {
    double floor[12] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0},
           rim[12] = {-1, 0, 0, 1, 0, 0, -1, 0.02, -1, 1, 0.02, -1};
    double slopes[18] = {0, -1, 0, 0, 1, 0, -1, -1, 0.5, -1, 1, 0.5, 1, -1, 0.5, 1, 1, 0.5};
    int32_t two[6] = {0, 1, 2, 0, 2, 3}, rims[6] = {0, 1, 2, 1, 3, 2}, four[12] = {0, 1, 2, 1, 3, 2, 0, 4, 1, 1, 4, 5};
    dem_cone c = dem_default_cone();
    dem_disc d = dem_default_disc();
    dem_screen s = dem_default_screen();
    if (wall == PLANE) dem_add_plane(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
    else if (wall == MESH) add_mesh(w, 4, floor, 2, two);
    else if (wall == BOX) dem_add_box(w, 0, dem_vec3(-1, -1, -0.05), dem_vec3(1, 1, 0));
    else if (wall == CONE || wall == TUBE) {
        c.low = wall == TUBE ? dem_vec3(0, -1, 0.1) : dem_vec3(0, 0, -0.5),
        c.high = wall == TUBE ? dem_vec3(0, 1, 0.1) : dem_vec3(0, 0, 0.05);
        c.low_radius = wall == TUBE ? 0.1 : 0.5, c.high_radius = wall == TUBE ? 0.1 : 0.01;
        dem_add_cone(w, 0, &c);
    } else if (wall == CYLINDER) dem_add_cylinder(w, 0, dem_vec3(0, 0, -0.1), dem_vec3(0, 1, 0), 0.1, 0);
    else if (wall == DISC) d.radius = 0.5, dem_add_disc(w, 0, &d);
    else if (wall == SCREEN) s.aperture = 0.008, s.wire = 0.003, s.half_x = s.half_y = 0.22, dem_add_screen(w, 0, &s);
    else if (wall == RIM) add_mesh(w, 4, rim, 2, rims);
    else {
        for (int k = 2; k < 18 && wall == RIDGE; k += 3) slopes[k] = -slopes[k];
        add_mesh(w, 6, slopes, 4, four);
    }
    assert_int_equal(w->walls, 1);
}
/* Returns whether a place is behind a wall. */
static int is_behind(int wall, dem_vec x) {
    switch (wall) {
    case CONE: return hypot(x.x, x.y) < 0.5 + (x.z + 0.5) / 0.55 * (0.01 - 0.5) - 1e-3 && x.z < 0.05;
    case TUBE: return hypot(x.x, x.z - 0.1) > 0.1;
    case CYLINDER: return hypot(x.x, x.z + 0.1) < 0.1;
    case RIDGE: return x.z < -0.5 * fabs(x.x);
    case VALLEY: return x.z < 0.5 * fabs(x.x);
    case RIM: return 0;
    default: return x.z < 0;
    }
}

/* ---- hits ---- */

typedef struct hit {
    double speed, softness, e; /* [m/s]; advised stiffness over that of the pair [-]; restitution */
    int64_t told;              /* steps in which the core was cut */
    double energy, deepest;    /* over that before, at e = 1 (frictionless); overlap over the rounding */
    int behind;                /* at any look */
} hit;
/* A body falls on a wall, turned at random. */
static void let_hit(int wall, int body, hit *h) {
    const dem_convex s = shape_of(body);
    dem_def def = dem_default_def();
    dem_world w, trial;
    double q[4], x[3] = {uniform(-1e-3, 1e-3), uniform(-1e-3, 1e-3), 1.05 * s.reach};
    for (int a = 0; a < 4; a++) q[a] = uniform(-1, 1) + uniform(-1, 1) + uniform(-1, 1);
    if (wall == CONE) x[0] += 0.1, x[2] = 1.6 * s.reach - 0.05;
    if (wall == VALLEY) x[2] = 1.5 * s.reach;
    dem_add_material(&def, 2500.0, 1e9, 0.2);
    dem_pair_def *pair = dem_pair(&def, 0, 0);
    pair->restitution = h->e, pair->friction = h->e < 1.0 ? 0.3 : 0.0, pair->stiffness = 1.0;
    def.gravity = dem_vec3(0, 0, 0);
    assert_int_equal(dem_init(&trial, &def, NULL), DEM_OK); /* to be advised */
    assert_int_equal(dem_add_convex(&trial, dem_add_shape(&trial, &s), 1, x, q, 0, 0), DEM_OK);
    add_wall(&trial, wall);
    pair->stiffness = dem_advise(&trial, DEM_LINEAR | DEM_FRICTION, h->speed).stiffness / h->softness;
    near(pair->stiffness * h->softness * s.radius * s.radius / (dem_mass(&trial, 0) * h->speed * h->speed), s.springs,
         1e-11);
    def.dt = sqrt(dem_mass(&trial, 0) / pair->stiffness) * RIDDLE_PI / (h->e < 1.0 ? 60.0 : 300.0);
    dem_free(&trial);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_add_convex(&w, dem_add_shape(&w, &s), 1, x, q, 0, 0), DEM_OK);
    add_wall(&w, wall);
    dem_set_motion(&w, 0, dem_vec3(0, 0, -h->speed), dem_vec3(uniform(-5, 5) * h->speed, uniform(-5, 5) * h->speed, 0));
    near(dem_advise(&w, DEM_LINEAR, h->speed).depth, sqrt(h->softness), 1e-12);
    const dem_energy_ledger before = dem_energy(&w);
    h->behind = 0, h->deepest = 0.0;
    for (int k = 0; k < 40; k++) {
        run(&w, 0.1 * s.reach / h->speed);
        h->behind |= is_behind(wall, dem_position(&w, 0));
        for (ptrdiff_t c = 0; c < dem_contact_count(&w); c++)
            h->deepest = fmax(h->deepest, -dem_get_contact(&w, c).gap / s.radius);
    }
    const dem_energy_ledger after = dem_energy(&w);
    h->energy = (after.kinetic + after.rotational) / (before.kinetic + before.rotational);
    h->told = dem_core_overlap_steps(&w);
    dem_free(&w);
}

/* At the advised stiffness nothing is deep; with a tenth of it nothing passes, and the run says that it is deep. */
static void test_none_passes(void **state) {
    (void)state;
    const int speeds = is_long() ? 20 : 2, turns = is_long() ? 20 : 2;
    for (int wall = 0; wall < WALLS; wall++) {
        for (int body = 0; body < BODIES; body++) {
            int64_t told = 0;
            for (int k = 0; k < speeds * turns; k++) {
                hit h = {0.1 * pow(200.0, (double)(k / turns) / (speeds - 1)), 1.0, 0.8, 0, 0.0, 0.0, 0};
                let_hit(wall, body, &h);
                if (h.behind || h.told > 0 || h.deepest > 1.0)
                    fail_msg("%s on %s at %g m/s: behind %d, deep in %ld steps, overlap %g", body_name[body],
                             wall_name[wall], h.speed, h.behind, (long)h.told, h.deepest);
                h.softness = 10.0;
                let_hit(wall, body, &h);
                if (h.behind || (h.deepest > 1.0 && h.told == 0))
                    fail_msg("%s on %s at %g m/s, soft: behind %d, %ld, %g", body_name[body], wall_name[wall], h.speed,
                             h.behind, (long)h.told, h.deepest);
                told += h.told;
            }
            if (told == 0) fail_msg("%s on %s: nothing was told", body_name[body], wall_name[wall]);
        }
    }
}

/* A deep contact is no other than a shallow one: without losses a body leaves as fast as it came. */
static void test_deep_hits_keep_energy(void **state) {
    (void)state;
    for (int wall = 0; wall <= DISC; wall++) {
        double worst = 0.0, deepest = 0.0;
        for (int k = 0; k < (is_long() ? 100 : 10); k++) {
            hit h = {3.0, k % 2 ? 10.0 : 30.0, 1.0, 0, 0.0, 0.0, 0};
            let_hit(wall, k / 2 % BODIES, &h);
            worst = fmax(worst, fabs(h.energy - 1.0)), deepest = fmax(deepest, h.deepest);
            assert_false(h.behind);
        }
        print_message("%s: energy within %.1e, overlaps up to %.1f roundings\n", wall_name[wall], worst, deepest);
        assert_true(worst < 1e-3 && deepest > 2.0);
    }
}

/* A floor is a floor: as a plane, a mesh of two triangles or of 200, a box's lid, a disc. */
static void test_floors_are_alike(void **state) {
    (void)state;
    dem_vec end[5], spin[5];
    for (int kind = 0; kind < 5; kind++) {
        dem_def def = dem_default_def();
        dem_world w;
        dem_add_material(&def, 2500.0, 1e9, 0.2); /* the default's stiffness */
        def.dt = 2e-5;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        dem_convex s;
        assert_int_equal(dem_make_brick(&s, dem_vec3(0.05, 0.05, 0.05), 0.03, NULL), DEM_OK);
        if (kind < 3) add_wall(&w, kind == 0 ? PLANE : kind == 1 ? MESH : BOX);
        else if (kind == 3) add_wall(&w, DISC);
        else {
            double v[3 * 121];
            int32_t c[600];
            for (int k = 0; k < 121; k++)
                v[3 * k] = 0.2 * (k % 11 - 5) / 5.0, v[3 * k + 1] = 0.2 * (k / 11 - 5) / 5.0, v[3 * k + 2] = 0.0;
            for (int k = 0; k < 100; k++) {
                const int32_t at = 11 * (k / 10) + k % 10, corners[6] = {at, at + 1, at + 12, at, at + 12, at + 11};
                memcpy(c + 6 * k, corners, sizeof corners);
            }
            add_mesh(&w, 121, v, 200, c);
        }
        const double x[3] = {0.03, 0.02, 0.4}, q[4] = {0.4, 0.7, 0.3, 0.5};
        assert_int_equal(dem_add_convex(&w, dem_add_shape(&w, &s), 1, x, q, 0, 0), DEM_OK);
        run(&w, 0.34);
        assert_true(dem_core_overlap_steps(&w) > 10);
        end[kind] = dem_position(&w, 0), spin[kind] = dem_spin(&w, 0);
        near(end[kind].x, end[0].x, 1e-9), near(end[kind].z, end[0].z, 1e-9), near(spin[kind].x, spin[0].x, 1e-6),
            near(spin[kind].z, spin[0].z, 1e-6);
        dem_free(&w);
    }
}

/* Overlap and force grow without a jump as a body is pressed into a sheet, from the first touch until its
   centre is near. */
static void test_force_over_depth(void **state) {
    (void)state;
    const int walls[] = {MESH, BOX, DISC, TUBE, CONE};
    for (int k = 0; k < 5; k++) {
        double before = 0.0, steepest = 0.0, most = 0.0;
        for (int n = 0; n < 160; n++) {
            const double step = 1e-4;
            dem_def def = dem_default_def();
            dem_world w;
            dem_add_material(&def, 2500.0, 1e9, 0.2);
            dem_pair(&def, 0, 0)->stiffness = 1.0, dem_pair(&def, 0, 0)->restitution = 1.0;
            def.dt = 1e-9, def.gravity = dem_vec3(0, 0, 0);
            assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
            const dem_convex s = shape_of(CUBE);
            add_wall(&w, walls[k]);
            const double x[3] = {walls[k] == CONE ? 0.1 : 1e-3, 2e-3,
                                 (walls[k] == CONE ? -0.051 + 0.023 : 0.017) - n * step},
                         q[4] = {0.5, 0.3, 0.6, 0.1};
            assert_int_equal(dem_add_convex(&w, dem_add_shape(&w, &s), 1, x, q, 0, 0), DEM_OK);
            run(&w, 1e-9);
            const dem_vec f = w.wall[0].force;
            const double force = sqrt(f.x * f.x + f.y * f.y + f.z * f.z);
            if (is_behind(walls[k], dem_position(&w, 0))) {
                dem_free(&w);
                break;
            }
            if (n > 0) steepest = fmax(steepest, fabs(force - before) / step);
            before = force, most = fmax(most, force);
            dem_free(&w);
        }
        print_message("%s: force up to %.3g roundings, slope up to %.2g springs\n", wall_name[walls[k]], most / 6e-4,
                      steepest);
        assert_true(most > 2e-3 && steepest < 1.25); /* a corner more is a quarter of a spring more; a jump of a
                                                        rounding would be 1.5 more in a step */
    }
}

/* A save in the middle of a deep contact goes on as if nothing had been. */
static void test_saved_when_deep(void **state) {
    (void)state;
    static unsigned char bytes[200000];
    dem_def def = dem_default_def();
    dem_world w, again;
    dem_add_material(&def, 2500.0, 1e9, 0.2);
    def.dt = 2e-5;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    const dem_convex s = shape_of(CUBE);
    const double x[6] = {0, 0, 0.02, 0.004, 0.003, 0.045}, q[8] = {0.4, 0.7, 0.3, 0.5, 0.1, 0.8, 0.3, 0.2};
    add_wall(&w, BOX);
    assert_int_equal(dem_add_convex(&w, dem_add_shape(&w, &s), 2, x, q, 0, 0), DEM_OK);
    dem_set_motion(&w, 0, dem_vec3(0, 0, -12), dem_vec3(0, 0, 0)),
        dem_set_motion(&w, 1, dem_vec3(0, 0, -12), dem_vec3(0, 0, 0));
    while (dem_core_overlap_steps(&w) < 5) run(&w, def.dt);
    const size_t size = dem_save(&w, bytes, sizeof bytes);
    assert_true(size > 0 && size <= sizeof bytes);
    assert_int_equal(dem_load(&again, bytes, size, NULL), DEM_OK);
    assert_int_equal(dem_core_overlap_steps(&again), dem_core_overlap_steps(&w));
    run(&w, 0.02), run(&again, 0.02);
    assert_true(dem_hash(&w) == dem_hash(&again));
    assert_int_equal(dem_core_overlap_steps(&again), dem_core_overlap_steps(&w));
    assert_true(dem_core_overlap_steps(&w) > 20);
    dem_free(&w), dem_free(&again);
}

/* A thin tile that falls flat, in few steps: below its thickness a step it does not pass, or the run says that it is
   deep; above it the run is refused. */
static void test_thin_and_fast(void **state) {
    (void)state;
    for (int k = 0; k < 6; k++) {
        const double ways[] = {0.3, 0.6, 0.9, 0.3, 0.9, 3.0}; /* a step, over its thickness */
        dem_def def = dem_default_def();
        dem_world w;
        dem_convex s;
        assert_int_equal(dem_make_brick(&s, dem_vec3(0.1, 0.1, 1e-3), 0.03, NULL), DEM_OK);
        dem_add_material(&def, 2500.0, 1e9, 0.2);
        def.gravity = dem_vec3(0, 0, 0), def.dt = ways[k] * 1e-3 / 5.0;
        dem_pair(&def, 0, 0)->stiffness = 0.1 * 2500.0 * s.volume / (def.dt * def.dt);
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        const double x[3] = {0.03, 0.02, 0.0303};
        assert_int_equal(dem_add_convex(&w, dem_add_shape(&w, &s), 1, x, NULL, 0, 0), DEM_OK);
        add_wall(&w, k < 3 ? MESH : DISC);
        dem_set_motion(&w, 0, dem_vec3(0, 0, -5), dem_vec3(0, 0, 0));
        const dem_status status = dem_run(&w, 0.02, DEM_LINEAR | DEM_FRICTION);
        assert_int_equal(status, ways[k] > 1.0 ? DEM_TOO_FAST : DEM_OK);
        assert_true(status != DEM_OK || dem_position(&w, 0).z > 0.0 || dem_core_overlap_steps(&w) > 0);
        dem_free(&w);
    }
}

/* ---- pairs ---- */

/* Two bodies that begin in each other come apart, however they lie; none is thrown. */
static void test_come_apart(void **state) {
    (void)state;
    for (int body = 0; body < BODIES; body++) {
        for (int k = 0; k < (is_long() ? 200 : 12); k++) {
            const dem_convex s = shape_of(body);
            const double apart = s.half.x > 0.0 && k < 2 ? 0.25 * 0.02 : uniform(0.1, 0.5) * 0.02;
            dem_def def = dem_default_def();
            dem_world w;
            dem_add_material(&def, 2500.0, 1e9, 0.2);
            dem_pair_def *pair = dem_pair(&def, 0, 0);
            pair->restitution = 0.3, pair->stiffness = 1e4, pair->friction = k % 2 ? 0.5 : 0.0;
            def.gravity = dem_vec3(0, 0, 0), def.dt = 2e-5;
            assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
            double x[6] = {0, 0, 0, 0, 0, apart}, q[8];
            for (int a = 0; a < 8; a++) q[a] = k < 2 ? a % 4 == 0 : uniform(-1, 1);
            assert_int_equal(dem_add_convex(&w, dem_add_shape(&w, &s), 2, x, q, 0, 0), DEM_OK);
            run(&w, def.dt);
            const int began = dem_core_overlaps(&w) > 0;
            run(&w, 0.4);
            if (dem_core_overlaps(&w) > 0) fail_msg("%s %d: still in each other", body_name[body], k);
            assert_true(began || body == TABLET);
            const dem_vec v = dem_velocity(&w, 0);
            const double energy = 1e4 * 4.0 * 0.02 * 0.02; /* of four springs, a width deep */
            assert_true(dem_mass(&w, 0) * (v.x * v.x + v.y * v.y + v.z * v.z) < energy);
            dem_free(&w);
        }
    }
}

/* Hits of bodies so soft that cores overlap: they part, and none passes through the other. */
static void test_soft_pairs(void **state) {
    (void)state;
    double square = 0.0;
    int hits = 0;
    for (int body = 0; body < BODIES; body++) {
        for (int k = 0; k < (is_long() ? 100 : 6); k++) {
            const dem_convex s = shape_of(body);
            dem_def def = dem_default_def();
            dem_world w;
            dem_add_material(&def, 2500.0, 1e9, 0.2);
            const double m = 2500.0 * s.volume,
                         stiffness = (k % 2 ? 0.1 : 0.02) * 0.5 * m * 9.0 / (4.0 * s.radius * s.radius);
            dem_pair_def *pair = dem_pair(&def, 0, 0);
            pair->restitution = 1.0, pair->friction = 0.0, pair->stiffness = stiffness;
            def.gravity = dem_vec3(0, 0, 0), def.dt = RIDDLE_PI * sqrt(m / stiffness) / 300.0;
            assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
            double x[6] =
                {0, 0, 1.05 * s.reach, uniform(-0.3, 0.3) * s.reach, uniform(-0.3, 0.3) * s.reach, -1.05 * s.reach},
                   q[8];
            for (int a = 0; a < 8; a++) q[a] = uniform(-1, 1);
            assert_int_equal(dem_add_convex(&w, dem_add_shape(&w, &s), 2, x, q, 0, 0), DEM_OK);
            dem_set_motion(&w, 0, dem_vec3(0, 0, -1.5), dem_vec3(0, 0, 0)),
                dem_set_motion(&w, 1, dem_vec3(0, 0, 1.5), dem_vec3(0, 0, 0));
            const double before = dem_energy(&w).kinetic;
            run(&w, 2.0 * s.reach);
            const dem_energy_ledger after = dem_energy(&w);
            const double error = (after.kinetic + after.rotational) / before - 1.0;
            assert_int_equal(dem_contact_count(&w), 0);
            const dem_vec a = dem_position(&w, 0), b = dem_position(&w, 1), u = dem_velocity(&w, 0),
                          v = dem_velocity(&w, 1);
            assert_true((a.x - b.x) * (u.x - v.x) + (a.y - b.y) * (u.y - v.y) + (a.z - b.z) * (u.z - v.z) > 0.0);
            assert_false(a.z - b.z < -0.3 * s.reach && fabs(a.x - b.x) + fabs(a.y - b.y) < s.reach);
            square += error * error, hits++;
            dem_free(&w);
        }
    }
    print_message("soft pairs: rms error of the energy %.2g\n", sqrt(square / hits));
    assert_true(sqrt(square / hits) < 0.1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_none_passes),      cmocka_unit_test(test_deep_hits_keep_energy),
        cmocka_unit_test(test_floors_are_alike), cmocka_unit_test(test_force_over_depth),
        cmocka_unit_test(test_saved_when_deep),  cmocka_unit_test(test_thin_and_fast),
        cmocka_unit_test(test_come_apart),       cmocka_unit_test(test_soft_pairs),
    };
    return cmocka_run_group_tests_name("polyhedra through nothing", tests, NULL, NULL);
}
