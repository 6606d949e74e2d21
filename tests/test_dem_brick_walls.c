/* Edges and faces of polyhedra at walls that are not flat: wires, cylinders, edges and corners of meshes,
   rims of cones. */
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
static dem_quaternion turned(void) {
    dem_quaternion q;
    q.w = random_bell(&seed), q.x = random_bell(&seed), q.y = random_bell(&seed), q.z = random_bell(&seed);
    return q;
}
static void make(dem_world *w, double dt, double k, double e, double friction, dem_vec gravity) {
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 1000.0, 1e7, 0.3);
    dem_pair_def *pair = dem_pair(&def, m, m);
    pair->stiffness = k, pair->restitution = e, pair->friction = friction, pair->tangential_ratio = 0.8;
    def.dt = dt, def.gravity = gravity;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
}
static void put(dem_world *w, dem_vec lengths, dem_vec at, dem_quaternion turn) {
    dem_convex s;
    assert_int_equal(dem_make_brick(&s, lengths, 0.03, NULL), DEM_OK);
    const int shape = dem_add_shape(w, &s);
    const double x[3] = {at.x, at.y, at.z}, q[4] = {turn.w, turn.x, turn.y, turn.z};
    assert_int_equal(dem_add_convex(w, shape, 1, x, q, 0, 0), DEM_OK);
}
static const dem_quaternion straight = {1, 0, 0, 0};
static const dem_vec down = {0, 0, -9.81};

#define RUN(w, time) assert_int_equal(dem_run(w, time, DEM_LINEAR | DEM_FRICTION), DEM_OK)

/* A wall to rest on: two bars along y, 10 mm apart, whose tops are at z = 0. */
enum { TWO_CYLINDERS, SCREEN, TWO_BEAMS, BEAMS_OF_SHEET, KINDS };
static void add_support(dem_world *w, int kind) {
    if (kind == TWO_CYLINDERS) {
        for (int k = 0; k < 2; k++)
            dem_add_cylinder(w, 0, dem_vec3(k ? 0.005 : -0.005, 0, -0.001), dem_vec3(0, 1, 0), 0.001, 0);
    } else if (kind == SCREEN) {
        dem_screen s = dem_default_screen();
        s.aperture = 0.008, s.wire = 0.002, s.centre = dem_vec3(0, 0, -0.001), s.half_x = s.half_y = 0.045,
        s.circular = 0;
        assert_true(dem_add_screen(w, 0, &s) >= 0);
    } else {
        for (int k = 0; k < 2; k++) {
            const double x = k ? 0.005 : -0.005;
            const dem_vec low = dem_vec3(x - 0.001, -0.03, -0.002), high = dem_vec3(x + 0.001, 0.03, 0.0);
            if (kind == TWO_BEAMS) assert_true(dem_add_box(w, 0, low, high) >= 0);
            else { /* the top alone, of two triangles: four rims */
                double corner[12] = {low.x, low.y, 0, high.x, low.y, 0, high.x, high.y, 0, low.x, high.y, 0};
                int32_t face[6] = {0, 1, 2, 0, 2, 3};
                dem_mesh mesh;
                memset(&mesh, 0, sizeof mesh);
                mesh.vertices = 4, mesh.vertex = corner, mesh.triangles = 2, mesh.triangle = face;
                assert_true(dem_add_mesh(w, 0, &mesh) >= 0);
            }
        }
    }
}

/* A brick across them touches with its faces and edges, no corner: it lies still, as deep as its springs, and its
   energy stays. */
static void test_rests_across(void **state) {
    (void)state;
    /* a quarter at each point: two edges over each bar; over both its sides; of a screen also the bars across */
    const double springs[KINDS] = {1, 2, 2, 2};
    for (int kind = 0; kind < KINDS; kind++) {
        dem_world w;
        make(&w, 1e-5, 1e4, 0.5, 0.5, down);
        add_support(&w, kind);
        put(&w, dem_vec3(0.016, 0.014, 0.004), dem_vec3(0, 0, 0.002), straight);
        RUN(&w, 1.0);
        const dem_vec x = dem_position(&w, 0);
        const double sunk = 0.002 - x.z, m = dem_mass(&w, 0);
        const dem_vec spin = dem_spin(&w, 0), v = dem_velocity(&w, 0);
        near(sunk, m * 9.81 / (springs[kind] * 1e4), 1e-4 * sunk);
        near(x.x, 0.0, 1e-7), near(x.y, 0.0, 1e-7);
        assert_true(dem__length(v) < 1e-9 && dem__length(spin) < 1e-6);
        dem_free(&w);
    }
}

/* Over a hole: a brick wider than a tube's end, or a small disc, lies on its rim, a longer and narrower one bridges it
   with its edges. One that a corner of a mesh pokes in the middle of a face is carried by it. */
static void test_holes(void **state) {
    (void)state;
    for (int kind = 0; kind < 6; kind++) {
        dem_world w;
        make(&w, 1e-5, 1e4, 0.5, 0.5, down);
        /* a small disc; a hole in a large one, under a brick that lies on it, and under one on its rim */
        if (kind > 2) {
            dem_disc d = dem_default_disc();
            d.radius = kind == 3 ? 0.005 : 0.05, d.hole_radius = kind == 3 ? 0.002 : 0.005;
            assert_true(dem_add_disc(&w, 0, &d) >= 0);
        } else if (kind < 2) {
            dem_cone c;
            c.low = dem_vec3(0, 0, -0.02), c.high = dem_vec3(0, 0, 0), c.low_radius = c.high_radius = 0.005;
            assert_true(dem_add_cone(&w, 0, &c) >= 0);
        } else {
            double corner[12] = {-0.002, -0.002, -0.003, 0.002, -0.002, -0.003, 0, 0.002, -0.003, 0, 0, 0};
            int32_t face[9] = {0, 1, 3, 1, 2, 3, 2, 0, 3};
            dem_mesh mesh;
            memset(&mesh, 0, sizeof mesh);
            mesh.vertices = 4, mesh.vertex = corner, mesh.triangles = 3, mesh.triangle = face;
            assert_true(dem_add_mesh(&w, 0, &mesh) >= 0);
        }
        put(&w, kind == 1 || kind == 5 ? dem_vec3(0.016, 0.004, 0.004) : dem_vec3(0.016, 0.014, 0.004),
            dem_vec3(0, 0, 0.002), straight);
        RUN(&w, 0.5);
        /* points of the rim; four crossings, two points of the rim; the tip; points of both rims; four corners,
           points of the rim */
        const int points[6] = {16, 6, 1, 32, 20, 6};
        const double springs = fmin(0.25 * points[kind], 2.0); /* a quarter at each, two at most */
        near(0.002 - dem_position(&w, 0).z, dem_mass(&w, 0) * 9.81 / (springs * 1e4), 1e-9);
        assert_int_equal(dem_contact_count(&w), points[kind]);
        assert_true(dem__length(dem_velocity(&w, 0)) < 1e-9);
        dem_free(&w);
    }
}

/* Within a box of triangles nothing stands out: edges that face inwards, and those across its flat sides, are
   not touched. */
static void test_inside(void **state) {
    (void)state;
    dem_world w;
    make(&w, 1e-5, 1e4, 0.5, 0.5, down);
    assert_true(dem_add_box(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0.03, 0.03, 0.03)) >= 0);
    put(&w, dem_vec3(0.01, 0.012, 0.02), dem_vec3(0.005, 0.006, 0.01), straight);
    put(&w, dem_vec3(0.01, 0.012, 0.02), dem_vec3(0.02, 0.02, 0.01), straight);
    RUN(&w, 0.5);
    for (int k = 0; k < 2; k++) near(0.01 - dem_position(&w, k).z, dem_mass(&w, k) * 9.81 / 1e4, 1e-10);
    assert_true(dem_contact_count(&w) >= 8);
    dem_free(&w);
}

/* What is saved goes on with the same bits, on every kind of wall. */
static void test_saved(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        dem_world w, again;
        make(&w, 1e-5, 1e4, 0.5, 0.5, down);
        add_support(&w, kind);
        seed = 3;
        for (int k = 0; k < 8; k++)
            put(&w, dem_vec3(0.016, 0.014, 0.004), dem_vec3(uniform(-3e-3, 3e-3), 0, 0.012 + 0.022 * k), turned());
        RUN(&w, 0.1);
        const size_t size = dem_save(&w, NULL, 0);
        unsigned char *bytes = (unsigned char *)malloc(size);
        assert_int_equal(dem_save(&w, bytes, size), size);
        assert_int_equal(dem_load(&again, bytes, size, NULL), DEM_OK);
        free(bytes);
        again.def.threads = 2;
        RUN(&w, 0.1);
        RUN(&again, 0.1);
        assert_true(dem_hash(&w) == dem_hash(&again));
        assert_true(w.contact_steps > 1000);
        dem_free(&w), dem_free(&again);
    }
}

/* On a woven screen: one wider than an aperture stays whichever way it lies, a narrower one falls through on end. */
static void test_screen(void **state) {
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        dem_world w;
        dem_screen s = dem_default_screen();
        make(&w, 1e-5, 1e4, 0.3, 0.3, down);
        s.aperture = 0.008, s.wire = 0.002, s.half_x = 0.045, s.profile = kind == 1 ? DEM_ROUND : DEM_SEMICIRCLE;
        assert_true(dem_add_screen(&w, 0, &s) >= 0);
        seed = 5;
        const double wide = kind == 2 ? 0.006 : 0.0085;
        for (int k = 0; k < 9; k++)
            put(&w, dem_vec3(wide, wide, 2.08 * wide), dem_vec3((k % 3 - 1) * 0.02, (k / 3 - 1) * 0.02, 0.012),
                kind == 2 ? straight : turned());
        RUN(&w, 0.4);
        for (int k = 0; k < 9; k++) {
            const double z = dem_position(&w, k).z;
            if (kind == 2) assert_true(z < -0.05);
            else assert_true(z > 0.003 && dem__length(dem_velocity(&w, k)) < 0.01);
        }
        dem_free(&w);
    }
}

/* Elastic hits at random on everything that stands out: root mean square error of the energy. */
enum { WIRES, HALF_WIRES, CYLINDER, BALL, BOX, SHEET, TUBE, CONE, DISC, RING, WALLS };
static const char *const name[WALLS] = {"round wires", "half-round wires", "cylinder", "sphere", "box",
                                        "sheet",       "tube's end",       "cone",     "disc",   "disc with a hole"};
static void add_wall(dem_world *w, int kind) {
    if (kind == WIRES || kind == HALF_WIRES) {
        dem_screen s = dem_default_screen();
        s.aperture = 0.9, s.wire = 0.3, s.half_x = 6.0 * 1.2, s.profile = kind == WIRES ? DEM_ROUND : DEM_SEMICIRCLE;
        assert_true(dem_add_screen(w, 0, &s) >= 0);
    } else if (kind == CYLINDER)
        assert_true(dem_add_cylinder(w, 0, dem_vec3(0, 0, -0.5), dem_vec3(0, 1, 0.1), 0.5, 0) >= 0);
    else if (kind == BALL) assert_true(dem_add_sphere_wall(w, 0, dem_vec3(0, 0, -0.5), 0.5, 0) >= 0);
    else if (kind == BOX) assert_true(dem_add_box(w, 0, dem_vec3(-0.3, -0.4, -1), dem_vec3(0.3, 0.4, 0)) >= 0);
    else if (kind == SHEET) {
        double corner[9] = {-0.4, -0.4, 0, 0.5, -0.3, 0, 0, 0.5, 0};
        int32_t face[3] = {0, 1, 2};
        dem_mesh mesh;
        memset(&mesh, 0, sizeof mesh);
        mesh.vertices = 3, mesh.vertex = corner, mesh.triangles = 1, mesh.triangle = face;
        assert_true(dem_add_mesh(w, 0, &mesh) >= 0);
    } else if (kind == DISC || kind == RING) {
        dem_disc d = dem_default_disc();
        d.radius = kind == DISC ? 0.4 : 0.8, d.hole_radius = kind == DISC ? 0.0 : 0.3;
        assert_true(dem_add_disc(w, 0, &d) >= 0);
    } else {
        dem_cone c;
        c.low = dem_vec3(0, 0, -1), c.high = dem_vec3(0, 0, 0), c.low_radius = kind == CONE ? 1.0 : 0.7,
        c.high_radius = kind == CONE ? 0.2 : 0.7;
        assert_true(dem_add_cone(w, 0, &c) >= 0);
    }
}
static void test_energy(void **state) {
    (void)state;
    for (int kind = 0; kind < WALLS; kind++) {
        double sum = 0.0, worst = 0.0;
        int hits = 0;
        seed = 7;
        while (hits < 40) {
            dem_world w;
            const double m = 2080.0, k = m / (0.006 * 0.006);
            make(&w, 3.14159265358979 * sqrt(m / k) / 200, k, 1.0, 0.0, dem_vec3(0, 0, 0));
            add_wall(&w, kind);
            put(&w, dem_vec3(1, 1, 2.08), dem_vec3(uniform(-0.5, 0.5), uniform(-0.5, 0.5), 1.4), turned());
            dem_set_motion(&w, 0, dem_vec3(0, 0, -1),
                           dem_vec3(0.3 * random_bell(&seed), 0.3 * random_bell(&seed), 0.3 * random_bell(&seed)));
            const dem_energy_ledger l = dem_energy(&w);
            const double before = l.kinetic + l.rotational;
            double lowest = 2.0;
            do {
                RUN(&w, 0.1);
                lowest = dem_position(&w, 0).z < lowest ? dem_position(&w, 0).z : lowest;
            } while (dem_position(&w, 0).z < 1.45 && dem_position(&w, 0).z > -1.5 && w.time < 4.0);
            const dem_energy_ledger after = dem_energy(&w);
            const double error = (after.kinetic + after.rotational) / before - 1.0;
            if (dem_contact_count(&w) == 0 && w.contact_steps > 0) {
                hits++, sum += error * error, worst = fabs(error) > fabs(worst) ? error : worst;
            }
            dem_free(&w);
        }
        print_message("elastic hits on %s: rms error of the energy %.2g, worst %.2g\n", name[kind], sqrt(sum / hits),
                      worst);
        assert_true(sqrt(sum / hits) < 3e-4);
    }
}

/* A cube of 4 mm, rounded by 0.4 mm, that has sunk into a wall: as deep as its rounding allows, and beyond, where the
   wall cuts its core, also where its corners have passed a sheet. Walls of kind 0 to 9: plane, box, cylinder from
   inside and outside, sphere from inside and outside, screen, disc, tube from inside and from outside. Returns
   what is counted. */
enum { CUT_KINDS = 10 };
static int64_t cut_by(int kind, double deep) {
    const double x = 2e-3 - deep, square = 2e-3 * 1.4142135623730951;
    const dem_vec up = dem_vec3(0, 0, 1), across = dem_vec3(0, 1, 0);
    dem_vec at = dem_vec3(0, 0, x);
    dem_screen screen = dem_default_screen();
    dem_cone tube = dem_default_cone();
    dem_disc disc = dem_default_disc();
    dem_world w;
    dem_convex cube;
    make(&w, 1e-7, 1e-3, 0.5, 0.5, dem_vec3(0, 0, 0));
    screen.aperture = 0.03, screen.wire = 2e-3, screen.centre = dem_vec3(16e-3, 16e-3, -1e-3),
    screen.half_x = screen.half_y = 0.048;
    screen.circular = 0;
    tube.low = dem_vec3(0, -0.02, 0), tube.high = dem_vec3(0, 0.02, 0), tube.low_radius = tube.high_radius = 0.01;
    switch (kind) {
    case 0: dem_add_plane(&w, 0, dem_vec3(0, 0, 0), up); break;
    case 1: dem_add_box(&w, 0, dem_vec3(-0.02, -0.02, 0), dem_vec3(0.021, 0.021, 0.02)); break;
    case 2: dem_add_cylinder(&w, 0, dem_vec3(0, 0, sqrt(1e-4 - 4e-6)), across, 0.01, 1); break;
    case 3: dem_add_cylinder(&w, 0, dem_vec3(0, 0, -1e-3), across, 1e-3, 0); break;
    case 4: dem_add_sphere_wall(&w, 0, dem_vec3(0, 0, sqrt(1e-4 - square * square)), 0.01, 1); break;
    case 5: dem_add_sphere_wall(&w, 0, dem_vec3(0, 0, -1e-3), 1e-3, 0); break;
    case 6: assert_true(dem_add_screen(&w, 0, &screen) >= 0); break;
    case 7: assert_true(dem_add_disc(&w, 0, &disc) >= 0); break;
    case 8: assert_true(dem_add_cone(&w, 0, &tube) >= 0), at.z = sqrt(1e-4 - 4e-6) - x; break;
    default: assert_true(dem_add_cone(&w, 0, &tube) >= 0), at.z = 0.01 + x; break;
    }
    assert_int_equal(dem_make_brick(&cube, dem_vec3(4e-3, 4e-3, 4e-3), 0.1, NULL), DEM_OK);
    near(cube.radius, 4e-4, 1e-15);
    assert_int_equal(dem_add_shape(&w, &cube), 0);
    const double place[3] = {at.x, at.y, at.z};
    assert_int_equal(dem_add_convex(&w, 0, 1, place, NULL, 0, 0), DEM_OK);
    assert_int_equal(dem_core_overlaps(&w), 0); /* nothing has run */
    RUN(&w, 1e-7);
    const int64_t n = dem_core_overlaps(&w);
    dem_free(&w);
    return n;
}
static void test_cut_cores(void **state) {
    (void)state;
    for (int kind = 0; kind < CUT_KINDS; kind++) {
        assert_int_equal(cut_by(kind, -1e-4), 0);
        assert_int_equal(cut_by(kind, 2e-4), 0);
        assert_int_equal(cut_by(kind, 6e-4), 1);
        assert_int_equal(cut_by(kind, 2e-3), 1);
    }
    /* a sphere whose centre is in a core */
    for (int deep = 0; deep < 2; deep++) {
        dem_world w;
        const double at[3] = {0, 0, deep ? 1.5e-3 : 1.7e-3}, d = 1e-3;
        make(&w, 1e-7, 1e-3, 0.5, 0.5, dem_vec3(0, 0, 0));
        put(&w, dem_vec3(4e-3, 4e-3, 4e-3), dem_vec3(0, 0, deep ? 0 : -2e-4), straight);
        assert_int_equal(dem_add_spheres(&w, 1, at, &d, 0, 0), DEM_OK);
        RUN(&w, 1e-7);
        assert_int_equal(dem_core_overlaps(&w), deep);
        dem_free(&w);
    }
}

/* A cube's corner between two flanks of a mesh, or, with angle 0, on one; all turned. Returns its change of velocity in
   a step, in the frame of the valley. */
static dem_vec push_in_valley(double angle, double depth, dem_quaternion turn) {
    const double b = 0.05, h = b * tan(0.5 * angle);
    const dem_vec v[6] = {{0, -b, 0}, {0, b, 0}, {-b, -b, h}, {-b, b, h}, {b, -b, h}, {b, b, h}};
    int32_t face[12] = {0, 1, 2, 1, 3, 2, 0, 4, 1, 1, 4, 5};
    double corner[18];
    for (int k = 0; k < 6; k++) {
        const dem_vec x = dem__to_lab(turn, v[k]);
        corner[3 * k] = x.x, corner[3 * k + 1] = x.y, corner[3 * k + 2] = x.z;
    }
    dem_mesh mesh = {0};
    mesh.vertex = corner, mesh.vertices = 6, mesh.triangle = face, mesh.triangles = 4;
    dem_world w;
    make(&w, 1e-7, 1e3, 1.0, 0.0, dem_vec3(0, 0, 0));
    assert_true(dem_add_mesh(&w, 0, &mesh) >= 0);
    /* the corner (1, 1, 1) of a cube of 4 mm points down: turned about (1, -1, 0) by pi less its angle to z */
    const double half = 0.5 * (3.14159265358979323846 - acos(1.0 / sqrt(3.0))), s = sin(half) / sqrt(2.0);
    const dem_quaternion upset = {cos(half), s, -s, 0};
    dem_convex cube;
    assert_int_equal(dem_make_brick(&cube, dem_vec3(4e-3, 4e-3, 4e-3), 0.1, NULL), DEM_OK);
    const double tip = sqrt(3.0) * (2e-3 - cube.radius), height = tip + (cube.radius - depth) / cos(0.5 * angle);
    const dem_vec x = dem__to_lab(turn, dem_vec3(0, 0, height));
    const dem_quaternion q = dem__turns(turn, upset);
    const double at[3] = {x.x, x.y, x.z}, to[4] = {q.w, q.x, q.y, q.z};
    assert_int_equal(dem_add_convex(&w, dem_add_shape(&w, &cube), 1, at, to, 0, 0), DEM_OK);
    RUN(&w, 1e-7);
    const dem_vec push = dem__to_body(turn, dem_velocity(&w, 0));
    dem_free(&w);
    return push;
}

/* Two flanks push twice, however the valley lies in the mesh's frame. */
static void test_corner_in_valley(void **state) {
    (void)state;
    const double degree = 3.14159265358979323846 / 180.0, depth = 2e-5;
    const double one = push_in_valley(0.0, depth, straight).z;
    assert_true(one > 0.0);
    seed = 3;
    for (double angle = 27.0; angle < 60.0; angle += 4.0) {
        for (int k = 0; k < 20; k++) {
            dem_quaternion turn = k ? turned() : straight;
            const double length = sqrt(turn.w * turn.w + turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
            turn.w /= length, turn.x /= length, turn.y /= length, turn.z /= length;
            const dem_vec push = push_in_valley(angle * degree, depth, turn);
            near(push.z / one, 2.0 * cos(0.5 * angle * degree), 1e-6);
            near(push.x / one, 0.0, 1e-6);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rests_across), cmocka_unit_test(test_holes), cmocka_unit_test(test_inside),
        cmocka_unit_test(test_cut_cores),    cmocka_unit_test(test_saved), cmocka_unit_test(test_screen),
        cmocka_unit_test(test_energy),       cmocka_unit_test(test_corner_in_valley),
    };
    if (getenv("RIDDLE_TEST")) cmocka_set_test_filter(getenv("RIDDLE_TEST"));
    return cmocka_run_group_tests(tests, NULL, NULL);
}
