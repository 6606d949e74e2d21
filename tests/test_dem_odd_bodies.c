/* Clumps and polyhedra where others are seldom: in drums, through exits, across periodic edges, thin, long, tiny and
   huge; and feeds of them from a surface. Energy, momentum, saves and threads hold as everywhere. */
#include "dem.h"
#include "../examples/common/random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#include "near.h"

static uint64_t seed = 1;
static double uniform(double low, double high) { return low + (high - low) * random_plain(&seed); }
static dem_def definition(double dt, double k, double e, dem_vec gravity) {
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 1000.0, 1e7, 0.3);
    dem_pair_def *pair = dem_pair(&def, m, m);
    pair->stiffness = k, pair->restitution = e, pair->friction = 0.5, pair->tangential_ratio = 0.8;
    def.dt = dt, def.gravity = gravity;
    return def;
}
static int brick(dem_world *w, double a, double b, double c, double rounding) {
    dem_convex s;
    assert_int_equal(dem_make_brick(&s, dem_vec3(a, b, c), rounding, NULL), DEM_OK);
    const int shape = dem_add_shape(w, &s);
    assert_true(shape >= 0);
    return shape;
}
static void turned(double q[4]) {
    for (int a = 0; a < 4; a++) q[a] = uniform(-1, 1);
}
static void put(dem_world *w, int shape, double x, double y, double z) {
    const double at[3] = {x, y, z};
    double q[4];
    turned(q);
    assert_int_equal(dem_add_convex(w, shape, 1, at, q, 0, 0), DEM_OK);
}
static void put_clump(dem_world *w, const dem_clump *c, double x, double y, double z) {
    const double at[3] = {x, y, z};
    double q[4];
    turned(q);
    assert_int_equal(dem_add_clumps(w, 1, c, at, NULL, q, 0, 0), DEM_OK);
}
static void put_sphere(dem_world *w, double x, double y, double z, double d) {
    const double at[3] = {x, y, z};
    assert_int_equal(dem_add_spheres(w, 1, at, &d, 0, 0), DEM_OK);
}

static const dem_vec down = {0, 0, -9.81};

/* ---- scenes: what must hold in each ---- */

/* Bricks, a clump and spheres in a drum of a cylinder and two planes that turns. */
static void drum(dem_world *w, int threads) {
    dem_def def = definition(5e-6, 4000.0, 0.5, dem_vec3(0, -9.81, 0));
    const double at[6] = {0, 0, 0, 2e-3, 0, 0}, d[2] = {3e-3, 2e-3};
    dem_clump c;
    def.threads = threads;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
    const int wall[3] = {dem_add_cylinder(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 0.015, 1),
                         dem_add_plane(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)),
                         dem_add_plane(w, 0, dem_vec3(0, 0, 0.0165), dem_vec3(0, 0, -1))};
    for (int k = 0; k < 3; k++)
        assert_int_equal(dem_rotate(w, wall[k], dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 12.0), DEM_OK);
    assert_int_equal(dem_make_clump(2, at, d, &c), DEM_OK);
    const int shape = brick(w, 2e-3, 2e-3, 4.16e-3, 0.05);
    for (int k = 0; k < 36; k++) {
        const double x = 5.2e-3 * (k % 3 - 1), y = 5.2e-3 * (k / 3 % 4 - 1.5), z = 3e-3 + 5.2e-3 * (k / 12);
        if (k % 9 == 4) put_sphere(w, x, y, z, 3e-3);
        else if (k % 9 == 7) put_clump(w, &c, x, y, z);
        else put(w, shape, x, y, z);
    }
}

/* The same in a drum of triangles. */
static void drum_of_mesh(dem_world *w, int threads) {
    enum { SIDES = 24 };
    double vertex[6 * SIDES];
    int32_t corner[6 * SIDES];
    dem_def def = definition(5e-6, 4000.0, 0.5, dem_vec3(0, -9.81, 0));
    dem_mesh mesh;
    def.threads = threads;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
    memset(&mesh, 0, sizeof mesh);
    for (int k = 0; k < SIDES; k++) {
        const double angle = 2.0 * RIDDLE_PI * k / SIDES;
        for (int m = 0; m < 2; m++) {
            double *v = vertex + 3 * (2 * k + m);
            v[0] = 0.015 * riddle_cos(angle), v[1] = 0.015 * riddle_sin(angle), v[2] = m ? 0.013 : -0.001;
        }
        const int32_t a = 2 * k, b = (2 * k + 2) % (2 * SIDES), own[6] = {a, b, b + 1, a, b + 1, a + 1};
        for (int m = 0; m < 6; m++) corner[6 * k + m] = own[m];
    }
    mesh.vertices = 2 * SIDES, mesh.vertex = vertex, mesh.triangles = 2 * SIDES, mesh.triangle = corner;
    const int round = dem_add_mesh(w, 0, &mesh);
    assert_true(round >= 0);
    assert_true(dem_add_plane(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) >= 0);
    assert_true(dem_add_plane(w, 0, dem_vec3(0, 0, 0.012), dem_vec3(0, 0, -1)) >= 0);
    assert_int_equal(dem_rotate(w, round, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 12.0), DEM_OK);
    const int shape = brick(w, 2e-3, 2e-3, 4.16e-3, 0.05);
    for (int k = 0; k < 24; k++)
        put(w, shape, 5.2e-3 * (k % 3 - 1), 5.2e-3 * (k / 3 % 4 - 1.5), 3e-3 + 5.2e-3 * (k / 12));
}

/* Plates and needles of aspect 20, spheres and a clump of 64 spheres fall into a box of triangles. */
static void thin_ones(dem_world *w, int threads) {
    dem_def def = definition(1e-6, 2000.0, 0.5, down);
    double at[192], d[64];
    dem_clump c;
    def.threads = threads;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
    assert_true(dem_add_box(w, 0, dem_vec3(-0.012, -0.012, 0), dem_vec3(0.012, 0.012, 0.1)) >= 0);
    for (int k = 0; k < 64; k++)
        d[k] = 1.2e-3, at[3 * k] = k % 4 * 1e-3, at[3 * k + 1] = k / 4 % 4 * 1e-3, at[3 * k + 2] = k / 16 * 1e-3;
    assert_int_equal(dem_make_clump(64, at, d, &c), DEM_OK);
    const int plate = brick(w, 8e-3, 8e-3, 4e-4, 0.3), needle = brick(w, 4e-4, 4e-4, 8e-3, 0.3);
    put_clump(w, &c, 0, 0, 0.004);
    for (int k = 0; k < 12; k++)
        put(w, k % 2 ? plate : needle, uniform(-3e-3, 3e-3), uniform(-3e-3, 3e-3), 0.014 + 6.5e-3 * k);
    for (int k = 0; k < 6; k++) put_sphere(w, -0.009 + 3.5e-3 * k, 0.0085, 2e-3, 2e-3);
}

/* Bricks and clumps that cross the edges of a periodic box, two of it lying on them, over a shaken floor. */
static void periodic(dem_world *w, int threads) {
    dem_def def = definition(5e-6, 4000.0, 0.5, down);
    const double at[9] = {0, 0, 0, 1.5e-3, 0, 0, 1.5e-3, 1e-3, 0}, d[3] = {2e-3, 2e-3, 1.5e-3};
    dem_clump c;
    def.threads = threads;
    for (int a = 0; a < 2; a++) def.periodic[a] = 1;
    def.low = dem_vec3(0, 0, 0), def.high = dem_vec3(0.0156, 0.0156, 1.0);
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
    const int floor_wall = dem_add_plane(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
    assert_int_equal(dem_vibrate(w, floor_wall, dem_vec3(1e-4, 0, 3e-4), dem_vec3(0, 0, 0), 50.0), DEM_OK);
    assert_int_equal(dem_make_clump(3, at, d, &c), DEM_OK);
    const int shape = brick(w, 2e-3, 2e-3, 4.16e-3, 0.05);
    for (int k = 0; k < 27; k++) {
        const double x = 5.2e-3 * (k % 3), y = 5.2e-3 * (k / 3 % 3), z = 3e-3 + 5.2e-3 * (k / 9);
        if (k % 4 == 3) put_clump(w, &c, x, y, z);
        else put(w, shape, x, y, z);
    }
}

/* Bricks that tumble fast and a few spheres, without gravity, about two crossed paddles that turn in a tube, which is
   periodic along its axis: most of the time all fly close to each other or to a wall. */
static void paddles(dem_world *w, int threads) {
    dem_def def = definition(5e-6, 4000.0, 0.9, dem_vec3(0, 0, 0));
    def.threads = threads, def.periodic[2] = 1;
    def.low = dem_vec3(-0.03, -0.03, 0), def.high = dem_vec3(0.03, 0.03, 0.016);
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
    const int wall[2] = {dem_add_box(w, 0, dem_vec3(-0.02, -5e-4, -0.02), dem_vec3(0.02, 5e-4, 0.036)),
                         dem_add_box(w, 0, dem_vec3(-5e-4, -0.02, -0.02), dem_vec3(5e-4, 0.02, 0.036))};
    for (int k = 0; k < 2; k++)
        assert_int_equal(dem_rotate(w, wall[k], dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 40.0), DEM_OK);
    assert_true(dem_add_cylinder(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 0.025, 1) >= 0);
    const int shape = brick(w, 2e-3, 2e-3, 4.16e-3, 0.05);
    for (int k = 0; k < 24; k++) { /* three layers of two by two in two quarters */
        const double side = k % 8 < 4 ? 1.0 : -1.0, x = side * (5.2e-3 * (k % 2 + 0.6) + 1e-3),
                     y = side * (5.2e-3 * (k / 2 % 2 + 0.6) + 1e-3);
        if (k % 9 == 4) put_sphere(w, x, y, 2.6e-3 + 5.2e-3 * (k / 8), 3e-3);
        else put(w, shape, x, y, 2.6e-3 + 5.2e-3 * (k / 8));
        const dem_vec v = dem_vec3(uniform(-0.5, 0.5), uniform(-0.5, 0.5), uniform(-0.5, 0.5));
        assert_int_equal(dem_set_motion(w, k, v, dem_vec3(uniform(-400, 400), uniform(-400, 400), uniform(-400, 400))),
                         DEM_OK);
    }
}

typedef struct scene {
    const char *name;
    void (*build)(dem_world *w, int threads);
    double time, error; /* [s]; of the energy released and the walls' work */
} scene;

static void in_scene(const scene *s) {
    enum { FEATURES = DEM_LINEAR | DEM_FRICTION | DEM_ENERGY };
    uint64_t hash[3];
    double error = 0.0;
    /* The second on two threads, saved half-way; the third tests everything in every step. */
    for (int run = 0; run < 3; run++) {
        dem_world w, again;
        seed = 5;
        s->build(&w, run == 1 ? 2 : 1);
        if (run == 2) w.def.skip = 0;
        const ptrdiff_t n = w.count;
        assert_int_equal(dem_run(&w, 0.5 * s->time, FEATURES), DEM_OK);
        if (run == 1) {
            const size_t size = dem_save(&w, NULL, 0);
            unsigned char *bytes = (unsigned char *)malloc(size);
            assert_int_equal(dem_save(&w, bytes, size), size);
            assert_int_equal(dem_load(&again, bytes, size, NULL), DEM_OK);
            free(bytes);
            dem_free(&w), w = again;
        }
        assert_int_equal(dem_run(&w, 0.5 * s->time, FEATURES), DEM_OK);
        assert_true(w.contact_steps > 1000);
        assert_int_equal(w.count, n);
        assert_int_equal(dem_core_overlaps(&w), 0);
        for (ptrdiff_t i = 0; i < n; i++) {
            const dem_body b = dem_get_body(&w, i);
            const dem_quaternion q = b.orientation;
            assert_true(w.alive[i] == 1 && dem__length(b.position) < 0.2 && dem__length(b.velocity) < 5.0 &&
                        dem__length(b.spin) < 1e5);
            near(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z, 1.0, 1e-12);
        }
        const dem_energy_ledger l = dem_energy(&w);
        error = fabs(l.error) / (l.released + fabs(l.wall_work));
        hash[run] = dem_hash(&w);
        dem_free(&w);
    }
    print_message("    %s: energy open by %.1e\n", s->name, error);
    assert_true(hash[0] == hash[1] && hash[0] == hash[2]);
    assert_true(error < s->error);
}
static void test_scenes(void **state) {
    (void)state;
    static const scene all[] = {{"drum", drum, 0.08, 5e-3},
                                {"drum of triangles", drum_of_mesh, 0.06, 5e-3},
                                {"plates and needles", thin_ones, 0.05, 5e-3},
                                {"periodic, shaken", periodic, 0.06, 5e-3},
                                {"paddles", paddles, 0.05, 5e-3}};
    for (int k = 0; k < 5; k++) in_scene(&all[k]);
}

/* ---- across periodic edges ---- */

/* The same hit of two bodies in the middle of a periodic box and across its edges and corner: the same states;
   momentum is kept. */
static void test_hits_across_edges(void **state) {
    (void)state;
    const double ends[6] = {0, 0, 0, 3e-3, 0, 0}, d[2] = {3e-3, 2e-3};
    dem_clump c;
    assert_int_equal(dem_make_clump(2, ends, d, &c), DEM_OK);
    for (int clumps = 0; clumps < 2; clumps++) {
        dem_vec v[3][2], s[3][2];
        for (int place = 0; place < 3; place++) { /* middle, edge, corner */
            dem_def def = definition(2e-6, 5000.0, 0.7, dem_vec3(0, 0, 0));
            dem_world w;
            for (int a = 0; a < 3; a++) def.periodic[a] = 1;
            def.low = dem_vec3(0, 0, 0), def.high = dem_vec3(0.02, 0.02, 0.02);
            assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
            const int shape = brick(&w, 2e-3, 2e-3, 4.16e-3, 0.05);
            const double x = place ? 0.0 : 0.01, yz = place > 1 ? 0.0 : 0.01;
            seed = 9;
            for (int k = 0; k < 2; k++) {
                if (clumps) put_clump(&w, &c, x + (k ? 3.5e-3 : -3.5e-3), yz + 5e-4 * k, yz);
                else put(&w, shape, x + (k ? 3.5e-3 : -3.5e-3), yz + 5e-4 * k, yz);
                assert_int_equal(
                    dem_set_motion(&w, w.count - 1, dem_vec3(k ? -0.5 : 0.5, 0, 0), dem_vec3(30, 20 * k, -40)), DEM_OK);
            }
            const dem_vec before = dem_momentum(&w);
            assert_int_equal(dem_run(&w, 0.015, DEM_LINEAR | DEM_FRICTION), DEM_OK);
            assert_true(w.contact_steps > 20);
            const dem_vec change = dem__sub(dem_momentum(&w), before);
            assert_true(dem__length(change) < 1e-13 * dem_mass(&w, 0));
            for (int k = 0; k < 2; k++) {
                const dem_body b = dem_get_body(&w, k ? w.count - 1 : 0);
                v[place][k] = b.velocity, s[place][k] = b.spin;
            }
            dem_free(&w);
        }
        for (int place = 1; place < 3; place++) {
            for (int k = 0; k < 2; k++) {
                assert_true(dem__length(dem__sub(v[place][k], v[0][k])) < 1e-9);
                assert_true(dem__length(dem__sub(s[place][k], s[0][k])) < 1e-6);
            }
        }
    }
}

/* ---- sizes ---- */

/* A brick and a clump of 4 um to 8 m fall on a plane; all lengths, gravity with them, and stiffness scale: so do places
   and velocities. */
static void test_any_size(void **state) {
    (void)state;
    dem_vec x[3][2], v[3][2];
    const double scale[3] = {1.0, 1.0 / 1024.0, 2048.0};
    for (int n = 0; n < 3; n++) {
        const double s = scale[n], ends[6] = {0, 0, 0, 3e-3 * s, 0, 0}, d[2] = {3e-3 * s, 2e-3 * s};
        dem_def def = definition(5e-6, 4000.0 * s * s * s, 0.5, dem_vec3(0, 0, -9.81 * s));
        dem_world w;
        dem_clump c;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        assert_true(dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) >= 0);
        assert_int_equal(dem_make_clump(2, ends, d, &c), DEM_OK);
        seed = 2;
        put(&w, brick(&w, 2e-3 * s, 2e-3 * s, 4.16e-3 * s, 0.05), 0, 0, 3e-3 * s);
        put_clump(&w, &c, 8e-3 * s, 0, 3e-3 * s);
        assert_int_equal(dem_run(&w, 0.03, DEM_LINEAR | DEM_FRICTION), DEM_OK);
        assert_true(w.contact_steps > 50);
        for (int k = 0; k < 2; k++) {
            const dem_body b = dem_get_body(&w, k);
            x[n][k] = dem__scale(1.0 / s, b.position), v[n][k] = dem__scale(1.0 / s, b.velocity);
        }
        dem_free(&w);
    }
    for (int n = 1; n < 3; n++) {
        for (int k = 0; k < 2; k++) {
            assert_true(dem__length(dem__sub(x[n][k], x[0][k])) < 1e-9);
            assert_true(dem__length(dem__sub(v[n][k], v[0][k])) < 1e-6);
        }
    }
}

/* ---- exits ---- */

/* Bricks and clumps fall off the end of a floor and through an exit: one record each, with the diameter
   of its volume. */
static void test_through_exits(void **state) {
    (void)state;
    dem_def def = definition(5e-6, 4000.0, 0.5, down);
    const double ends[6] = {0, 0, 0, 2e-3, 0, 0}, d[2] = {3e-3, 2e-3};
    dem_world w;
    dem_clump c;
    dem_passed record[16];
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_true(dem_add_plane(&w, 0, dem_vec3(0, 0, -0.02), dem_vec3(0, 0, 1)) >= 0);
    const int exit = dem_add_exit(&w, dem_vec3(0, 0, -0.01), dem_vec3(0, 0, 1));
    assert_true(exit >= 0);
    assert_int_equal(dem_make_clump(2, ends, d, &c), DEM_OK);
    const int shape = brick(&w, 2e-3, 2e-3, 4.16e-3, 0.05);
    for (int k = 0; k < 8; k++) {
        if (k % 2) put_clump(&w, &c, 1e-3 * k, 0, 4e-3 * k);
        else put(&w, shape, 1e-3 * k, 0, 4e-3 * k);
    }
    const double volume = 2e-3 * 2e-3 * 4.16e-3,
                 expected[2] = {riddle_cbrt(6.0 / RIDDLE_PI * volume), dem_clump_diameter(&c)};
    assert_int_equal(dem_run(&w, 0.2, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY), DEM_OK);
    assert_int_equal(dem_take_passed(&w, record, 16), 8);
    for (int k = 0; k < 8; k++) {
        assert_int_equal(record[k].exit, exit);
        near(record[k].diameter, fabs(record[k].diameter - expected[0]) < 1e-6 ? expected[0] : expected[1], 1e-15);
        assert_true(record[k].position.z < -0.01 + 1e-9 && record[k].velocity.z < 0.0);
    }
    const dem_energy_ledger l = dem_energy(&w);
    assert_true(fabs(l.error) < 1e-3 * l.released);
    dem_free(&w);
}

/* ---- definitions ---- */

/* A cube's corners in any order make the same cube; corners given twice, or within 1e-12, are no corners. */
static void test_corners_in_any_order(void **state) {
    (void)state;
    double corner[27];
    int order[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    const char *reason = NULL;
    dem_convex s;
    for (int trial = 0; trial < 50; trial++) {
        for (int k = 7; k > 0; k--) {
            const int other = (int)uniform(0, k + 1), kept = order[k];
            order[k] = order[other], order[other] = kept;
        }
        for (int k = 0; k < 24; k++) corner[k] = 5.0 + 1e-3 * (order[k / 3] >> k % 3 & 1);
        assert_int_equal(dem_make_convex(&s, 8, corner, 0.03, NULL), DEM_OK);
        assert_true(s.corners == 8 && s.faces == 6 && s.edges == 12);
        near(s.volume, 1e-9, 1e-20);
        for (int a = 0; a < 3; a++) near(s.moment[a], 1e-15 / 6.0, 1e-26);
    }
    for (int far_off = 0; far_off < 2; far_off++) {
        for (int a = 0; a < 3; a++) corner[24 + a] = corner[a] + far_off * 1e-15;
        assert_int_equal(dem_make_convex(&s, 9, corner, 0.03, &reason), DEM_BAD_ARGUMENT);
        assert_non_null(reason);
    }
}

/* Clumps whose volume or moments are no numbers are refused, by dem_add_clumps and by feeds; nothing is added. */
static void test_numbers_of_clumps(void **state) {
    (void)state;
    dem_def def = definition(5e-6, 4000.0, 0.5, down);
    const double ends[6] = {0, 0, 0, 2e-3, 0, 0}, d[2] = {3e-3, 2e-3}, bad[5] = {0.0, -1.0, NAN, HUGE_VAL, 1e-320},
                 at[3] = {0, 0, 0};
    dem_world w;
    dem_clump c;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_make_clump(2, ends, d, &c), DEM_OK);
    for (int field = 0; field < 5; field++) {
        for (int k = 0; k < 5; k++) {
            dem_clump broken = c;
            double *const place[5] = {&broken.volume, &broken.moments.x, &broken.moments.z, &broken.radius[1],
                                      &broken.centre[1].y};
            /* a place may be anywhere */
            if (field == 4 && (bad[k] == 0.0 || bad[k] == -1.0 || bad[k] == 1e-320)) continue;
            *place[field] = bad[k];
            dem_feed feed = dem_default_feed();
            feed.clump = &broken;
            assert_int_equal(dem_add_clumps(&w, 1, &broken, at, NULL, NULL, 0, 0), DEM_BAD_ARGUMENT);
            assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT);
        }
    }
    assert_int_equal(w.count, 0);
    dem_free(&w);
}

/* ---- feeds from a surface ---- */

enum { BODIES_MAX = 4000 };
typedef struct counts {
    int walls[BODIES_MAX], mates[BODIES_MAX]; /* contacts begun, by the body's number */
    int pieces, began, ended;
} counts;
static void begins(dem_world *w, const int32_t *slots, ptrdiff_t n, void *user) {
    counts *q = (counts *)user;
    for (ptrdiff_t k = 0; k < n; k++) {
        const dem_contact_info c = dem_get_contact(w, slots[k]);
        const uint64_t i = w->id[c.i] / (uint64_t)q->pieces;
        q->began++;
        if (c.j < 0) q->walls[i]++;
        else q->mates[i]++, q->mates[w->id[c.j] / (uint64_t)q->pieces]++;
    }
}
static void ends_of(dem_world *w, int32_t slot, void *user) {
    (void)w, (void)slot;
    ((counts *)user)->ended++;
}
static const dem_law counted = {
    "counted", 1, 3, 3, 1, DEM_LINEAR_CONSTANTS, dem_prepare_linear, dem_force_linear_friction, begins, ends_of};
DEM_KERNEL(counting, counted, DEM_LINEAR | DEM_FRICTION)

/* Clumps with a distribution of sizes, and polyhedra, come from a face with a mass flow and a scatter of velocities,
   fall on a plane and leave below: mass comes as asked to within half a body, and every contact is counted for its body
   by its kind. */
static void feed_from_a_face(int polyhedra) {
    static counts found;
    const double ends[6] = {0, 0, 0, 0.6, 0, 0}, d[2] = {1, 0.8};
    dem_def def = definition(5e-6, 4000.0, 0.5, down);
    dem_world w;
    dem_clump c;
    memset(&found, 0, sizeof found);
    def.periodic[0] = 1, def.low = dem_vec3(0, 0, -1), def.high = dem_vec3(0.03, 1, 1);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    w.user = &found, found.pieces = polyhedra ? 1 : 2;
    const int slope = dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, -0.6, 0.8));
    const int exit = dem_add_exit(&w, dem_vec3(0, -0.02, 0), dem_vec3(0, 1, 0));
    assert_true(slope == 0 && exit == 1);
    assert_int_equal(dem_make_clump(2, ends, d, &c), DEM_OK);
    dem_feed feed = dem_default_feed();
    feed.region = dem_box_region(dem_vec3(0, 0.005, 0.025), dem_vec3(0.03, 0.02, 0.025));
    feed.velocity = dem_vec3(0, 0, -0.6), feed.scatter = dem_vec3(0.1, 0.1, 0.2);
    if (polyhedra) feed.polyhedron = 1 + brick(&w, 1.4e-3, 1.4e-3, 2.9e-3, 0.05);
    else feed.clump = &c, feed.sizes = dem_lognormal_sizes(1.8e-3, 0.15, 1.2e-3, 2.6e-3, 1);
    const double flow = 8e-4;
    double mass = 0.0, sum = 0.0, square = 0.0;
    ptrdiff_t n = 0;
    for (int k = 1; k <= 150; k++) {
        const ptrdiff_t before = w.count;
        assert_int_equal(dem_feed_mass(&w, &feed, flow, 2e-3), DEM_OK);
        for (ptrdiff_t i = before; i < w.count; i += found.pieces) {
            const dem_body b = dem_get_body(&w, i);
            assert_true(fabs(b.velocity.x) <= 0.1 && fabs(b.velocity.z + 0.6) <= 0.2 &&
                        fabs(b.position.z - 0.025) < 1e-9);
            mass += b.mass, n++;
            sum += b.velocity.z + 0.6, square += (b.velocity.z + 0.6) * (b.velocity.z + 0.6);
        }
        assert_true(fabs(mass - flow * 2e-3 * k) < 1e-5); /* a body at most, none waits */
        near(feed.placed_mass, mass, 1e-12 * mass);
        assert_int_equal(dem_run_law(&w, 2e-3, &counting), DEM_OK);
    }
    assert_true(n == feed.placed && n > 40 && n < BODIES_MAX);
    assert_true(fabs(sum / (double)n) < 3.0 * 0.2 / sqrt(3.0 * (double)n)); /* uniform within 0.2 */
    near(square / (double)n, 0.04 / 3.0, 4.0 * 0.04 / 3.0 / sqrt((double)n));
    int walls = 0, mates = 0;
    for (ptrdiff_t k = 0; k < n; k++) walls += found.walls[k], mates += found.mates[k];
    assert_true(walls > n / 2 && mates % 2 == 0 && mates > 0);
    assert_int_equal(walls + mates / 2, found.began);
    assert_int_equal(found.began - found.ended, dem_contact_count(&w));
    static dem_passed record[BODIES_MAX];
    const ptrdiff_t out = dem_take_passed(&w, record, BODIES_MAX);
    ptrdiff_t inside = 0;
    for (ptrdiff_t i = 0; i < w.count; i++) inside += w.alive[i] && dem_get_body(&w, i).first == i;
    assert_true(out > n / 2 && out + inside == n);
    dem_free(&w);
}
static void test_feeds_from_a_face(void **state) {
    (void)state;
    for (int polyhedra = 0; polyhedra < 2; polyhedra++) feed_from_a_face(polyhedra);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scenes),
        cmocka_unit_test(test_hits_across_edges),
        cmocka_unit_test(test_any_size),
        cmocka_unit_test(test_through_exits),
        cmocka_unit_test(test_corners_in_any_order),
        cmocka_unit_test(test_numbers_of_clumps),
        cmocka_unit_test(test_feeds_from_a_face),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
