/* dem.h: faults that users ran into, each with others of its kind: what a caller does between runs stands in the books,
   records do not pile up, what decays comes to rest. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include "near.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dem.h"

static double length_of(dem_vec v) { return sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }
static dem_vec v3(double x, double y, double z) { return dem_vec3(x, y, z); }
static void run(dem_world *w, double t, int features) {
    const dem_status status = dem_run(w, t, features);
    if (status != DEM_OK)
        fail_msg("%s, particle %lu, step %ld", dem_status_text(status), (unsigned long)w->failed_id, (long)w->step);
}

/* ---- what decays comes to rest ---- */

static int is_subnormal(double v) { return v != 0.0 && fabs(v) < DBL_MIN; }
static int subnormals_of(dem_vec v) { return is_subnormal(v.x) + is_subnormal(v.y) + is_subnormal(v.z); }

/* In speeds, spins and histories, and in their squares. */
static int count_subnormals(const dem_world *w) {
    int n = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_vec v = dem_velocity(w, i), s = w->particle[i].spin;
        n += subnormals_of(v) + subnormals_of(s) + subnormals_of(w->particle[i].a) + subnormals_of(w->spin_rate[i]);
        n += subnormals_of(v3(v.x * v.x, v.y * v.y, v.z * v.z)) + subnormals_of(v3(s.x * s.x, s.y * s.y, s.z * s.z));
    }
    for (ptrdiff_t k = 0; k < dem_contact_count(w); k++) {
        const dem_contact_info c = dem_get_contact(w, k);
        for (int a = 0; a < DEM_STATE_MAX; a++) n += is_subnormal(c.state[a]) + is_subnormal(c.state[a] * c.state[a]);
    }
    for (int k = 0; k < w->walls; k++) n += is_subnormal(w->wall[k].rate) + subnormals_of(w->wall[k].velocity);
    return n;
}

/* Balls of several kinds on a plane, 3 ms being more than a thousand steps of decay. */
static void on_plane(dem_world *w, double rolling, double tangential_damping, double restitution) {
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 2500.0, 1e8, 0.2);
    dem_pair_def *p = dem_pair(&def, m, m);
    p->rolling = rolling, p->friction = 0.5, p->restitution = restitution, p->tangential_damping = tangential_damping,
    p->stiffness = 1e4;
    def.dt = 5e-6;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
    dem_add_plane(w, m, v3(0, 0, 0), v3(0, 0, 1));
    for (int i = 0; i < 12; i++) {
        const double c[3] = {0.0058 * (i / 2), 0.02 * (i % 2), 0.003}, d = 0.006; /* six in a row overlap: a chain */
        assert_int_equal(dem_add_spheres(w, 1, c, &d, m, 0), DEM_OK);
        dem_set_motion(w, i, v3(0.05, 0.01 * i, 0), v3(-1.0 * i, 0.05 / 0.003, i % 3 ? 0.0 : 5.0));
    }
}
static void test_no_subnormal_numbers(void **state) {
    (void)state;
    for (int k = 0; k < 16; k++) {
        const int features = (k & 1 ? DEM_HERTZ : DEM_LINEAR) | DEM_FRICTION | DEM_ROLLING | (k & 2 ? DEM_ENERGY : 0);
        dem_world w;
        int n = 0;
        on_plane(&w, 3e-4, k & 4 ? 0.5 : 0.0, k & 8 ? 0.2 : 0.9);
        for (int q = 0; q < 60; q++) {
            run(&w, 0.01, features);
            n += count_subnormals(&w);
        }
        assert_int_equal(n, 0);
        dem_free(&w);
    }
}

/* A rotor and a piston whose dampers stop them, and the ball that they carry; a motion too small to be one. */
static void test_no_subnormal_walls(void **state) {
    (void)state;
    dem_world w;
    on_plane(&w, 3e-4, 0.5, 0.2);
    const int rotor = dem_add_plane(&w, 0, v3(0, 0, 1), v3(0, 0, -1)),
              piston = dem_add_plane(&w, 0, v3(0, 0, 2), v3(0, 0, -1));
    assert_int_equal(dem_rotate(&w, rotor, v3(0, 0, 1), v3(0, 0, 1), 3.0), DEM_OK);
    assert_int_equal(dem_control_torque(&w, rotor, v3(0, 0, 1), v3(0, 0, 1), 1e-6, 0.0, 1e-3), DEM_OK);
    assert_int_equal(dem_move(&w, piston, v3(0, 0, 0.01)), DEM_OK);
    assert_int_equal(dem_control_force(&w, piston, v3(0, 0, 1), 1e-3, 0.0, 2.0), DEM_OK);
    for (int q = 0; q < 200; q++) {
        run(&w, 0.01, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING);
        assert_int_equal(count_subnormals(&w), 0);
    }
    near_absolute(w.wall[rotor].rate, 0.0, 1e-90, "rotor");
    near_absolute(w.wall[piston].rate, 0.0, 1e-90, "piston");
    assert_int_equal(dem_set_motion(&w, 0, v3(1e-310, 0, 0), v3(0, 1e-300, 0)), DEM_OK);
    assert_int_equal(count_subnormals(&w), 0);
    dem_free(&w);
}

/* A ball below its rolling limit: the default law, which resists in proportion to a slow spin, creeps at 5 g sin dt;
   contact_epsd, which has a spring, stands still (test_dem_laws). */
static void test_creep_of_the_default_law(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        const double dt = 8e-6 / (1 << k), slope = 0.05, radius = 0.003;
        dem_def def = dem_default_def();
        const int m = dem_add_material(&def, 2500.0, 1e8, 0.2);
        dem_world w;
        dem_pair_def *p = dem_pair(&def, m, m);
        p->rolling = 3e-4, p->friction = 0.5, p->restitution = 0.3, p->tangential_damping = 1.0, p->stiffness = 1e4;
        def.dt = dt, def.gravity = v3(9.81 * slope, 0, -9.81);
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        const double c[3] = {0, 0, radius}, d = 2.0 * radius;
        dem_add_plane(&w, m, v3(0, 0, 0), v3(0, 0, 1));
        dem_add_spheres(&w, 1, c, &d, m, 0);
        run(&w, 0.2, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING);
        near_relative(dem_velocity(&w, 0).x, 5.0 * 9.81 * slope * dt, 1e-2, "creep");
        dem_free(&w);
    }
}

/* ---- solid bodies, meshes as regions, walls for some groups ---- */

static void empty_world(dem_world *w) {
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 2500.0, 1e8, 0.2);
    dem_pair(&def, m, m)->stiffness = 1e3;
    def.dt = 1e-5;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
}
static dem_feed small_spheres(double diameter, double low, double high) {
    dem_feed f = dem_default_feed();
    f.sizes = dem_one_size(diameter);
    f.region = dem_box_region(v3(low, low, low), v3(high, high, high));
    return f;
}
static int count_in(const dem_world *w, const dem_region *r) {
    int n = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) n += dem_region_holds(r, dem_position(w, i));
    return n;
}

/* An octahedron of radius r about the origin: volume 4/3 r^3, faces at r/sqrt(3). unwelded: three corners of its own
   for each face; turned: every other face the wrong way round; faces: 8 or fewer. */
typedef struct body {
    double vertex[72];
    int32_t triangle[24];
    dem_mesh mesh;
} body;
static void octahedron(body *o, double r, int unwelded, int turned, int faces) {
    memset(o, 0, sizeof *o);
    for (int k = 0; k < 8; k++) {
        const int odd = (k & 1) ^ (k >> 1 & 1) ^ (k >> 2 & 1) ^ (turned && k % 3 == 1);
        for (int c = 0; c < 3; c++) {
            const int axis = odd ? 2 - c : c, at = unwelded ? 3 * k + c : 2 * axis + (k >> axis & 1);
            for (int a = 0; a < 3; a++) o->vertex[3 * at + a] = a == axis ? (k >> axis & 1 ? r : -r) : 0.0;
            o->triangle[3 * k + c] = at;
        }
    }
    o->mesh.vertex = o->vertex, o->mesh.triangle = o->triangle;
    o->mesh.vertices = unwelded ? 24 : 6, o->mesh.triangles = faces;
}
static double above_octahedron(dem_vec x, double r) { return (fabs(x.x) + fabs(x.y) + fabs(x.z) - r) / sqrt(3.0); }

/* No sphere is put inside a solid block, which may have been moved and turned; a container stays a sheet. */
static void test_fill_around_solids(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        dem_world w;
        empty_world(&w);
        const int box = dem_add_box(&w, 0, v3(0, 0, 0), v3(0.1, 0.1, 0.1));
        const int block = dem_add_box(&w, 0, v3(0.03, 0.03, 0.03), v3(0.07, 0.07, 0.07));
        dem_feed f = small_spheres(0.004, 0.0, 0.1);
        const dem_region in_block = dem_box_region(v3(0.03, 0.03, 0.03), v3(0.07, 0.07, 0.07));
        (void)box;
        if (k > 0) assert_int_equal(dem_set_solid(&w, block, 1), DEM_OK);
        if (k == 2) { /* by 1 cm to the side, and saved */
            dem_move(&w, block, v3(0.1, 0, 0));
            run(&w, 0.1, DEM_LINEAR);
            static unsigned char saved[1 << 20];
            const size_t size = dem_save(&w, saved, sizeof saved);
            assert_true(size > 0 && size <= sizeof saved);
            dem_free(&w);
            assert_int_equal(dem_load(&w, saved, size, NULL), DEM_OK);
        }
        /* turned by 45 degrees about the vertical through its middle: the corners of the old place are free */
        if (k == 3) {
            dem_rotate(&w, block, v3(0.05, 0.05, 0.05), v3(0, 0, 1), RIDDLE_PI / 4.0 / 0.1);
            run(&w, 0.1, DEM_LINEAR);
        }
        assert_int_equal(dem_fill(&w, &f, 3000), DEM_OK);
        int inside = 0;
        for (ptrdiff_t i = 0; i < w.count; i++) {
            dem_vec x = dem_position(&w, i);
            if (k == 2) x.x -= 0.01;
            if (k == 3) {
                const double p = (x.x - 0.05 + x.y - 0.05) / sqrt(2.0), q = (x.y - x.x) / sqrt(2.0);
                x.x = 0.05 + p, x.y = 0.05 + q;
            }
            inside += dem_region_holds(&in_block, x);
        }
        assert_true(k == 0 ? inside > 50 : inside == 0);
        assert_true(w.count > 2000);
        dem_free(&w);
    }
}

static void test_what_is_solid(void **state) {
    (void)state;
    dem_world w;
    body o;
    empty_world(&w);
    dem_cone cone = dem_default_cone();
    dem_screen screen = dem_default_screen();
    const int no[] = {dem_add_plane(&w, 0, v3(0, 0, -1), v3(0, 0, 1)),
                      dem_add_cylinder(&w, 0, v3(0, 0, 0), v3(0, 0, 1), 1.0, 1),
                      dem_add_sphere_wall(&w, 0, v3(0, 0, 0), 1.0, 1),
                      dem_add_cone(&w, 0, &cone),
                      dem_add_screen(&w, 0, &screen),
                      dem_add_exit(&w, v3(0, 0, -1), v3(0, 0, 1)),
                      -1,
                      w.walls};
    for (size_t k = 0; k < sizeof no / sizeof *no; k++) assert_int_equal(dem_set_solid(&w, no[k], 1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_solid(NULL, 0, 1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_solid(&w, no[0], 0), DEM_OK); /* it is none */
    for (int k = 0; k < 8; k++) {                          /* whole or without a face; welded or not; turned or not */
        octahedron(&o, 0.1, k & 1, k & 2, k & 4 ? 7 : 8);
        const int wall = dem_add_mesh(&w, 0, &o.mesh);
        assert_true(wall >= 0);
        assert_int_equal(dem_set_solid(&w, wall, 1), k & 4 ? DEM_BAD_ARGUMENT : DEM_OK);
        const dem_region r = dem_mesh_region(&o.mesh);
        assert_int_equal(dem_region_holds(&r, v3(0, 0, 0)), !(k & 4));
        assert_int_equal(dem_region_holds(&r, v3(0.034, 0.034, 0.034)), 0);
        assert_int_equal(dem_region_holds(&r, v3(0.033, 0.033, 0.033)), !(k & 4));
        if (!(k & 6)) near_relative(dem_region_volume(&r), 4.0 / 3.0 * 1e-3, 1e-12, "volume");
        if (k & 4) assert_true(isnan(dem_region_volume(&r)));
    }
    octahedron(&o, 0.1, 0, 0, 8); /* a face twice */
    memcpy(&o.triangle[21], &o.triangle[0], 3 * sizeof o.triangle[0]);
    assert_int_equal(dem_set_solid(&w, dem_add_mesh(&w, 0, &o.mesh), 1), DEM_BAD_ARGUMENT);
    octahedron(&o, 0.1, 0, 0, 8);
    o.vertex[0] = (double)NAN;
    dem_region r = dem_mesh_region(&o.mesh);
    assert_int_equal(dem_region_holds(&r, v3(0, 0, 0)), 0);
    r = dem_mesh_region(NULL);
    assert_true(isnan(dem_region_volume(&r)));
    dem_feed f = small_spheres(0.01, 0.0, 1.0);
    f.region = r;
    assert_int_equal(dem_fill(&w, &f, 1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_remove_region(&w, &r), -DEM_BAD_ARGUMENT);
    dem_free(&w);
}

/* Random points: the octahedron's formula says what is inside, lines through corners and edges included. */
static void test_inside_of_a_mesh(void **state) {
    (void)state;
    body o;
    octahedron(&o, 0.1, 0, 0, 8);
    const dem_region r = dem_mesh_region(&o.mesh);
    int inside = 0;
    for (int k = 0; k < 40000; k++) {
        /* Also above edges, corners. */
        const dem_vec x = v3((k % 41 - 20) * 0.006, (k / 41 % 41 - 20) * 0.006, (k / 1681 - 11) * 0.0091);
        const double above = above_octahedron(x, 0.1);
        if (fabs(above) < 1e-12) continue;
        if (dem_region_holds(&r, x) != (above < 0.0)) fail_msg("%g %g %g", x.x, x.y, x.z);
        inside += above < 0.0;
    }
    assert_true(inside > 500);
}

static void test_fill_a_mesh(void **state) {
    (void)state;
    body o;
    for (int as_wall = 0; as_wall < 2; as_wall++) { /* the mesh as a container of its own, or a region only */
        dem_world w;
        octahedron(&o, 0.1, as_wall, 0, 8);
        empty_world(&w);
        if (as_wall) assert_true(dem_add_mesh(&w, 0, &o.mesh) >= 0);
        dem_feed f = small_spheres(0.008, 0.0, 1.0);
        f.region = dem_mesh_region(&o.mesh);
        assert_int_equal(dem_fill(&w, &f, 500), DEM_OK);
        assert_true(w.count > 300);
        for (ptrdiff_t i = 0; i < w.count; i++)
            assert_true(above_octahedron(dem_position(&w, i), 0.1) <= -0.004 + 1e-12);
        dem_measure m, box;
        const dem_region all = dem_box_region(v3(-1, -1, -1), v3(1, 1, 1));
        assert_int_equal(dem_measure_region(&w, &f.region, &m), DEM_OK);
        assert_int_equal(dem_measure_region(&w, &all, &box), DEM_OK);
        assert_int_equal(m.count, w.count);
        /* None is cut. */
        near_relative(m.solid_fraction * 4.0 / 3.0 * 1e-3, box.solid_fraction * 8.0, 1e-12, "solid volume");
        /* Cuts many. */
        body half;
        octahedron(&half, 0.05, 0, 0, 8);
        const dem_region inner = dem_mesh_region(&half.mesh);
        assert_int_equal(dem_measure_region(&w, &inner, &m), DEM_OK);
        assert_int_equal(m.count, count_in(&w, &inner));
        assert_true(m.solid_fraction > 0.1 && m.solid_fraction < 0.5);
        const ptrdiff_t before = w.count;
        assert_int_equal(dem_remove_region(&w, &inner), m.count);
        run(&w, 1e-5, DEM_LINEAR);
        assert_true(before > m.count && m.count > 10);
        f.region = inner; /* there is room again: a source in a mesh */
        assert_int_equal(dem_feed_number(&w, &f, 1e6, 1e-5), DEM_OK);
        assert_true(f.placed > 500 - f.missed);
        f.sizes = dem_one_size(0.2); /* larger than the box around it */
        f.waiting = 0.0;
        const ptrdiff_t placed = f.placed;
        assert_int_equal(dem_fill(&w, &f, 3), DEM_OK);
        assert_int_equal(f.placed, placed);
        dem_free(&w);
    }
}

/* A plane that holds group 1 only, and an exit that takes group 40 only. */
static void test_walls_for_groups(void **state) {
    (void)state;
    dem_world w;
    empty_world(&w);
    const int plane = dem_add_plane(&w, 0, v3(0, 0, 0), v3(0, 0, 1)),
              exit = dem_add_exit(&w, v3(0, 0, -0.05), v3(0, 0, 1));
    assert_int_equal(dem_set_wall_groups(&w, plane, 1u << 1), DEM_OK);
    assert_int_equal(dem_set_wall_groups(&w, exit, 1u << 31), DEM_OK);
    assert_int_equal(dem_set_wall_groups(&w, 7, 1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_wall_groups(NULL, 0, 1), DEM_BAD_ARGUMENT);
    const int group[3] = {1, 5, 40};
    for (int i = 0; i < 3; i++) {
        const double c[3] = {0.01 * i, 0, 0.002}, d = 0.004;
        assert_int_equal(dem_add_spheres(&w, 1, c, &d, 0, group[i]), DEM_OK);
    }
    dem_feed f = small_spheres(0.004, 0.1, 0.1045);
    /* Across the plane: it is not there for this group. */
    f.region.low.z = -0.0021, f.region.high.z = 0.002, f.group = 5;
    assert_int_equal(dem_fill(&w, &f, 1), DEM_OK);
    assert_int_equal(f.placed, 1);
    f.group = 1, f.region.low.x = 0.2, f.region.high.x = 0.2045;
    assert_int_equal(dem_fill(&w, &f, 1), DEM_OK);
    assert_int_equal(f.placed, 1);
    run(&w, 0.2, DEM_LINEAR | DEM_ENERGY);
    near_absolute(dem_position(&w, 0).z, 0.002, 1e-4, "held");
    near_absolute(dem_position(&w, 1).z, 0.002 - 0.5 * 9.81 * 0.04, 1e-9, "fell");
    assert_int_equal(w.passed_count, 1);
    assert_int_equal(w.passed[0].group, 40);
    /* the floor is taken away: what the contact stores is removed */
    assert_int_equal(dem_set_wall_groups(&w, plane, 0), DEM_OK);
    run(&w, 0.1, DEM_LINEAR | DEM_ENERGY);
    assert_true(dem_position(&w, 0).z < -0.04);
    near_absolute(dem_energy(&w).error, 0.0, 1e-9, "ledger");
    dem_free(&w);
}

/* ---- what the caller does between runs stands in the books ---- */

static const double radius = 0.002, diameter = 0.004, stiffness = 1e3, depth = 1e-4;

/* One material without loss, no gravity, dt = t_c/180. */
static void lossless(dem_world *w, double friction) {
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 2500.0, 1e7, 0.2);
    dem_pair_def *p = dem_pair(&def, m, m);
    p->restitution = 1.0, p->stiffness = stiffness, p->friction = friction;
    def.gravity = v3(0, 0, 0), def.dt = 1e-6;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
}
static void put(dem_world *w, double x, double y, double z) {
    const double c[3] = {x, y, z};
    assert_int_equal(dem_add_spheres(w, 1, c, &diameter, 0, 0), DEM_OK);
}
static int floor_of(dem_world *w) { return dem_add_plane(w, 0, v3(0, 0, 0), v3(0, 0, 1)); }
static void rest_motion(void *user, double time, dem_pose *pose) { (void)user, (void)time, (void)pose; }

/* A ball that has been on a floor with depth/2 of overlap since half a period, and what is done to it there. */
enum {
    OVERLAP_BEFORE,
    OVERLAP_ADDED,
    WALL_ENABLED,
    WALL_ADDED,
    WALL_DISABLED,
    WALL_GROUPS,
    REMOVED,
    REMOVED_BY_REGION,
    STIFFENED,
    SOFTENED,
    FRICTION_CHANGED,
    RESTITUTION_CHANGED,
    STEP_CHANGED,
    GRAVITY_ON,
    STRUCK,
    LOADED,
    WALL_MOVED,
    WALL_VIBRATED,
    WALL_TURNED,
    WALL_BELTED,
    WALL_PRESCRIBED,
    WALL_CONTROLLED,
    ACTS
};
static void pressed(dem_world *w, int act, int features) {
    const int plane = floor_of(w);
    if (act == OVERLAP_BEFORE) {
        put(w, 0, 0, radius - depth);
        return;
    }
    if (act == WALL_ENABLED) dem_enable_wall(w, plane, 0);
    if (act == WALL_ENABLED || act == WALL_ADDED) {
        put(w, 0, 0, act == WALL_ADDED ? 0.1 + radius - depth : radius - depth);
        run(w, 1e-4, features);
        if (act == WALL_ENABLED) assert_int_equal(dem_enable_wall(w, plane, 1), DEM_OK);
        else assert_true(dem_add_plane(w, 0, v3(0, 0, 0.1), v3(0, 0, 1)) >= 0);
        return;
    }
    put(w, 0, 0, radius + 1e-6); /* falls on the floor at a slant, and is stopped by its spring when the act comes */
    dem_set_motion(w, 0, v3(0.05, 0, -0.2), v3(0, 3, 0));
    run(w, 1e-6 / 0.2 + 0.5 * RIDDLE_PI * sqrt(dem_mass(w, 0) / stiffness), features);
}
static void do_act(dem_world *w, int act) {
    dem_pair_def p = *dem_pair(&w->def, 0, 0);
    const dem_region all = dem_box_region(v3(-1, -1, -1), v3(1, 1, 1));
    dem_status status = DEM_OK;
    switch (act) {
    case OVERLAP_ADDED: put(w, 0, 0, 3.0 * radius - 2.0 * depth); break;
    case WALL_DISABLED: status = dem_enable_wall(w, 0, 0); break;
    case WALL_GROUPS: status = dem_set_wall_groups(w, 0, ~1u); break;
    case REMOVED: status = dem_remove(w, 0); break;
    case REMOVED_BY_REGION: assert_int_equal(dem_remove_region(w, &all), 1); break;
    case STIFFENED: p.stiffness *= 2.0; break;
    case SOFTENED: p.stiffness *= 0.5; break;
    case FRICTION_CHANGED: p.friction = 0.1; break;
    case RESTITUTION_CHANGED: p.restitution = 0.5; break;
    case STEP_CHANGED: status = dem_set_time_step(w, 0.37e-6); break;
    case GRAVITY_ON: status = dem_set_gravity(w, v3(3.0, 0, -9.81)); break;
    case STRUCK: status = dem_set_motion(w, 0, v3(0.1, 0.2, -0.1), v3(10, 0, 0)); break;
    case LOADED: status = dem_set_load(w, 0, v3(1e-3, 0, -2e-3), v3(0, 1e-6, 0)); break;
    case WALL_MOVED: status = dem_move(w, 0, v3(0.1, 0, 0.1)); break;
    case WALL_VIBRATED: status = dem_vibrate(w, 0, v3(0, 0, 1e-4), v3(0, 0, 1.0), 100.0); break;
    case WALL_TURNED: status = dem_rotate(w, 0, v3(0.01, 0, 0), v3(0, 0, 1), 20.0); break;
    case WALL_BELTED: status = dem_set_belt(w, 0, v3(0.5, 0, 0)); break;
    case WALL_PRESCRIBED: status = dem_prescribe(w, 0, v3(0, 0, 0), rest_motion, NULL); break;
    case WALL_CONTROLLED: status = dem_control_force(w, 0, v3(0, 0, 1), 1e-2, 0.05, 0.0); break;
    default: break;
    }
    assert_int_equal(status, DEM_OK);
    if (act >= STIFFENED && act <= RESTITUTION_CHANGED) assert_int_equal(dem_set_pair(w, 0, 0, &p), DEM_OK);
}
static void test_callers_acts_are_booked(void **state) {
    (void)state;
    for (int k = 0; k < 3 * ACTS; k++) {
        const int act = k / 3, has_friction = k % 3 == 1, hertz = k % 3 == 2;
        const int features = (hertz ? DEM_HERTZ : DEM_LINEAR) | (has_friction ? DEM_FRICTION : 0) | DEM_ENERGY;
        char what[80];
        dem_world w;
        lossless(&w, has_friction ? 0.5 : 0.0);
        pressed(&w, act, features);
        do_act(&w, act);
        run(&w, 0.005, features);
        const dem_energy_ledger l = dem_energy(&w);
        double scale = l.kinetic + l.rotational + l.elastic + l.removed; /* in play */
        if (act == WALL_CONTROLLED) scale += fabs(l.wall_work);
        snprintf(what, sizeof what, "act %d, %s", act, hertz ? "Hertz" : has_friction ? "friction" : "smooth");
        assert_true(scale > 1e-8);
        near_absolute(l.error / scale, 0.0, 2e-3, what);
        if (!has_friction) near_absolute(l.sliding_loss / scale, 0.0, 1e-3, what);
        if (act == OVERLAP_BEFORE || act == WALL_ENABLED || act == WALL_ADDED) {
            if (!hertz) near_relative(l.kinetic + l.rotational, 0.5 * stiffness * depth * depth, 3e-3, what);
        }
        dem_free(&w);
    }
}

/* What is booked has the right size. */
static void test_size_of_the_bookings(void **state) {
    (void)state;
    const int features = DEM_LINEAR | DEM_ENERGY;
    const double stored = 0.5 * stiffness * depth * depth;
    for (int act = 0; act < 5; act++) {
        dem_world w;
        lossless(&w, 0.0);
        put(&w, 0, 0, 0);
        if (act > 0) put(&w, 0, 0, diameter - depth);
        run(&w, 0.0, features);
        const dem_energy_ledger before = dem_energy(&w);
        dem_pair_def p = *dem_pair(&w.def, 0, 0);
        p.stiffness *= 3.0;
        if (act == 0) put(&w, 0, 0, diameter - depth);
        if (act == 1) assert_int_equal(dem_set_pair(&w, 0, 0, &p), DEM_OK);
        if (act == 2) assert_int_equal(dem_remove(&w, 1), DEM_OK);
        if (act == 3) assert_int_equal(dem_set_gravity(&w, v3(0, 0, -2.0)), DEM_OK);
        if (act == 4) assert_int_equal(dem_set_motion(&w, 1, v3(0, 0, 3), v3(0, 0, 0)), DEM_OK);
        run(&w, 0.0, features);
        const dem_energy_ledger l = dem_energy(&w);
        const double raised = 2.0 * dem_mass(&w, 0) * (diameter - depth), struck = 4.5 * dem_mass(&w, 0);
        const double added[5] = {stored, 2.0 * stored, 0.0, raised, struck};
        near_absolute(l.added - before.added, added[act], 1e-12 * (added[act] + stored), "added");
        near_absolute(l.removed - before.removed, act == 2 ? stored : 0.0, 1e-12 * stored, "removed");
        near_absolute(l.error, 0.0, 1e-12 * (stored + added[act]), "error");
        dem_free(&w);
    }
}

static void test_set_gravity(void **state) {
    (void)state;
    dem_world w;
    lossless(&w, 0.5);
    floor_of(&w);
    put(&w, 0, 0, 1.0);    /* flies */
    put(&w, 1, 0, radius); /* will rest */
    dem_set_motion(&w, 0, v3(1, 0, 0), v3(0, 0, 0));
    run(&w, 0.1, DEM_LINEAR);
    near_absolute(dem_position(&w, 0).x, 0.1, 1e-12, "free");
    assert_int_equal(dem_set_gravity(&w, v3(0, 2, -10)), DEM_OK);
    run(&w, 0.1, DEM_LINEAR);
    near_absolute(dem_position(&w, 0).x, 0.2, 1e-12, "x");
    near_absolute(dem_position(&w, 0).y, 0.01, 1e-12, "y");
    near_absolute(dem_position(&w, 0).z, 1.0 - 0.05, 1e-12, "z");
    near_absolute(dem_position(&w, 1).y, 0.01, 1e-12, "slides without friction");
    assert_int_equal(dem_set_gravity(&w, v3(0, 0, 0)), DEM_OK);
    run(&w, 0.1, DEM_LINEAR);
    near_absolute(dem_position(&w, 0).y, 0.03, 1e-12, "goes on straight");
    const dem_vec bad[] = {v3((double)NAN, 0, 0), v3(0, (double)INFINITY, 0), v3(0, 0, 1e100)};
    for (size_t k = 0; k < 3; k++) assert_int_equal(dem_set_gravity(&w, bad[k]), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_gravity(NULL, v3(0, 0, 0)), DEM_BAD_ARGUMENT);
    assert_true(w.def.gravity.x == 0.0 && w.def.gravity.y == 0.0);
    dem_free(&w);
}

static void test_set_pair(void **state) {
    (void)state;
    dem_world w;
    lossless(&w, 0.2);
    floor_of(&w);
    dem_set_gravity(&w, v3(0, 0, -10));
    dem_pair_def p = *dem_pair(&w.def, 0, 0);
    p.restitution = 0.3;
    assert_int_equal(dem_set_pair(&w, 0, 0, &p), DEM_OK);
    put(&w, 0, 0, radius - 10.0 * 2500.0 * RIDDLE_PI / 6.0 * diameter * diameter * diameter / stiffness);
    dem_set_motion(&w, 0, v3(5, 0, 0), v3(0, 0, 0));
    const int features = DEM_LINEAR | DEM_FRICTION;
    run(&w, 0.1, features);
    near_relative(dem_velocity(&w, 0).x, 5.0 - 0.2, 1e-4, "slides with 0.2 g");
    p.friction = 0.4;
    assert_int_equal(dem_set_pair(&w, 0, 0, &p), DEM_OK);
    run(&w, 0.1, features);
    near_relative(dem_velocity(&w, 0).x, 5.0 - 0.6, 1e-4, "with 0.4 g");
    p.stiffness *= 4.0;
    assert_int_equal(dem_set_pair(&w, 0, 0, &p), DEM_OK);
    run(&w, 0.3, features);
    near_relative(dem_get_contact(&w, 0).gap, -10.0 * dem_mass(&w, 0) / p.stiffness, 1e-3,
                  "overlap of the stiffer contact");
    const dem_pair_def good = p;
    for (int k = 0; k < 6; k++) {
        p = good;
        double *field[] = {&p.stiffness, &p.restitution,      &p.friction,
                           &p.rolling,   &p.tangential_ratio, &p.tangential_damping};
        *field[k] = k == 1 ? 0.0 : -1.0;
        assert_int_equal(dem_set_pair(&w, 0, 0, &p), DEM_BAD_ARGUMENT);
        *field[k] = (double)NAN;
        assert_int_equal(dem_set_pair(&w, 0, 0, &p), DEM_BAD_ARGUMENT);
    }
    assert_int_equal(dem_set_pair(&w, 0, 0, NULL), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_pair(&w, 0, 1, &good), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_pair(&w, -1, 0, &good), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_pair(NULL, 0, 0, &good), DEM_BAD_ARGUMENT);
    assert_memory_equal(dem_pair(&w.def, 0, 0), &good, sizeof good);
    dem_free(&w);
}

static void test_set_time_step(void **state) {
    (void)state;
    dem_world w;
    lossless(&w, 0.5);
    floor_of(&w);
    dem_set_gravity(&w, v3(0, 0, -10));
    put(&w, 0, 0, 1.0);
    dem_set_motion(&w, 0, v3(1, 0, 0), v3(0, 0, 7));
    double time = 0.0;
    for (int k = 0; k < 20; k++) {
        assert_int_equal(dem_set_time_step(&w, 1e-6 * (1.0 + 0.31 * k)), DEM_OK);
        run(&w, 0.01, DEM_LINEAR | DEM_FRICTION);
        time += 0.01;
        near_absolute(w.time + w.owed, time, 1e-12, "time and what is owed");
        near_absolute(dem_position(&w, 0).z, 1.0 - 5.0 * w.time * w.time, 1e-11, "parabola");
    }
    const double bad[] = {0.0, -1e-6, (double)NAN, (double)INFINITY, 1e9};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        assert_int_equal(dem_set_time_step(&w, bad[k]), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_time_step(NULL, 1e-6), DEM_BAD_ARGUMENT);
    dem_free(&w);
}

/* ---- records do not pile up ---- */

static size_t held; /* bytes of the world under test */
static void *counting(void *user, void *old, size_t old_size, size_t new_size) {
    (void)user;
    held += new_size - old_size;
    if (new_size == 0) {
        free(old);
        return NULL;
    }
    return realloc(old, new_size);
}

/* A source and an exit: who takes the records holds a constant amount of memory, and loses none of them. */
static void test_records_are_taken(void **state) {
    (void)state;
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 2500.0, 1e7, 0.2);
    dem_pair(&def, m, m)->stiffness = 1e3;
    def.dt = 4e-6, def.allocator.fn = counting;
    dem_world w;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    dem_add_exit(&w, v3(0, 0, -0.02), v3(0, 0, 1));
    dem_feed f = dem_default_feed();
    f.region = dem_box_region(v3(0, 0, 0), v3(0.05, 0.05, 0.01));
    f.sizes = dem_one_size(0.001), f.velocity = v3(0, 0, -1);
    size_t first = 0, save = 0;
    ptrdiff_t taken = 0;
    double latest = 0.0;
    dem_passed records[40];
    for (int k = 0; k < 400; k++) {
        assert_int_equal(dem_feed_number(&w, &f, 20000.0, 0.005), DEM_OK);
        run(&w, 0.005, DEM_LINEAR);
        ptrdiff_t n;
        while ((n = dem_take_passed(&w, records, 40)) > 0) {
            for (ptrdiff_t q = 0; q < n; q++) {
                assert_true(records[q].time >= latest);
                latest = records[q].time;
            }
            taken += n;
        }
        assert_int_equal(n, 0);
        assert_int_equal(w.passed_count, 0);
        if (k == 40) first = held, save = dem_save(&w, NULL, 0);
    }
    assert_int_equal(taken, w.passed_total);
    assert_true(taken > 30000);
    ptrdiff_t present = 0;
    for (ptrdiff_t i = 0; i < w.count; i++) present += w.alive[i] == DEM_PRESENT;
    assert_int_equal(f.placed, taken + present);
    assert_true(held < 2 * first);
    assert_true(dem_save(&w, NULL, 0) < 3 * save / 2);
    assert_int_equal(dem_take_passed(&w, records, -1), -DEM_BAD_ARGUMENT);
    assert_int_equal(dem_take_passed(NULL, records, 1), -DEM_BAD_ARGUMENT);
    run(&w, 0.05, DEM_LINEAR);
    const ptrdiff_t left = w.passed_count;
    assert_true(left > 100);
    assert_int_equal(dem_take_passed(&w, NULL, 10), 10); /* dropped */
    assert_int_equal(w.passed_count, left - 10);
    assert_int_equal(dem_take_passed(&w, NULL, left), left - 10);
    dem_free(&w);
    assert_int_equal(held, 0);
}

/* The same from a stream that nobody takes: a save has them all, and they can be taken after loading. */
static void test_records_are_saved(void **state) {
    (void)state;
    dem_world w, again;
    empty_world(&w);
    dem_add_exit(&w, v3(0, 0, -0.01), v3(0, 0, 1));
    for (int i = 0; i < 20; i++) {
        const double c[3] = {0.01 * i, 0, 0.001 * i}, d = 0.004;
        dem_add_spheres(&w, 1, c, &d, 0, i);
    }
    run(&w, 0.2, DEM_LINEAR);
    assert_int_equal(w.passed_count, 20);
    assert_int_equal(dem_take_passed(&w, NULL, 5), 5);
    static unsigned char bytes[100000];
    const size_t size = dem_save(&w, bytes, sizeof bytes);
    assert_int_equal(dem_load(&again, bytes, size, NULL), DEM_OK);
    dem_passed p[20];
    assert_int_equal(again.passed_total, 20);
    assert_int_equal(dem_take_passed(&again, p, 20), 15);
    assert_int_equal(p[0].group, 5);
    dem_free(&w);
    dem_free(&again);
}

/* ---- contacts tell where they are, hooks why they end, worlds whether their step is too long ---- */

static void near_vec(dem_vec got, dem_vec wanted, double tolerance, const char *what) {
    near_absolute(got.x, wanted.x, tolerance, what), near_absolute(got.y, wanted.y, tolerance, what);
    near_absolute(got.z, wanted.z, tolerance, what);
}

static void test_normal_and_point(void **state) {
    (void)state;
    dem_world w;
    lossless(&w, 0.5);
    const double d[2] = {0.004, 0.008}, c[6] = {0, 0, 0.01, 0.0035, 0, 0.01 + 0.0048};
    assert_int_equal(dem_add_spheres(&w, 2, c, d, 0, 0), DEM_OK);
    dem_add_plane(&w, 0, v3(0, 0, 0.0081), v3(0, 0, 1));
    dem_add_cylinder(&w, 0, v3(0.0019 - 0.05, 0, 0), v3(0, 0, 1), 0.05, 1);
    dem_add_sphere_wall(&w, 0, v3(0, 0.0119, 0.01), 0.01, 0);
    dem_add_box(&w, 0, v3(-0.1, -0.0019, -0.1), v3(0.1, 0.1, 0.1));
    run(&w, 0.0, DEM_LINEAR | DEM_FRICTION);
    int seen = 0;
    for (ptrdiff_t k = 0; k < dem_contact_count(&w); k++) {
        const dem_contact_info q = dem_get_contact(&w, k);
        if (q.i != 0 && q.j < 0) continue;
        const double apart = sqrt(0.0035 * 0.0035 + 0.0048 * 0.0048);
        const dem_vec normal[] = {v3(0, 0, 1), v3(-1, 0, 0), v3(0, -1, 0), v3(0, 1, 0)},
                      point[] = {v3(0, 0, 0.0081), v3(0.0019, 0, 0.01), v3(0, 0.0019, 0.01), v3(0, -0.0019, 0.01)};
        if (q.j < 0) {
            near_vec(q.normal, normal[-1 - q.j], 1e-12, "normal of a wall");
            near_vec(q.point, point[-1 - q.j], 1e-12, "point of a wall");
        } else {
            near_vec(q.normal, v3(-0.0035 / apart, 0, -0.0048 / apart), 1e-12, "normal of a pair");
            near_vec(q.point, v3(0.0035 / 3.0, 0, 0.01 + 0.0048 / 3.0), 1e-12, "point of a pair");
        }
        seen |= 1 << (q.j < 0 ? -q.j : 0);
    }
    assert_int_equal(seen, 31);
    dem_free(&w);
}

/* What a hook of a law reads where a contact begins after a flight: the place of the particle at the end of the step,
   not a flight ahead. */
typedef struct landing {
    int seen;
    double worst; /* height of the lowest sphere of the particle over contact with the floor [m] */
} landing;
static void note_landing(struct dem_world *w, const int32_t *slots, ptrdiff_t n, void *user) {
    landing *l = (landing *)user;
    for (ptrdiff_t k = 0; k < n; k++) {
        const dem_contact_info c = dem_get_contact(w, slots[k]);
        const double lowest = dem_position(w, c.i).z - dem_radius(w, c.i), centre = dem_get_body(w, c.i).position.z;
        l->worst = fmax(l->worst, fabs(lowest)), l->worst = fmax(l->worst, fabs(c.point.z));
        if (centre < lowest) l->worst = HUGE_VAL;
        l->seen++;
    }
}
static const dem_law landing_law = {
    "landing", 1, 0, 0, 0, DEM_LINEAR_CONSTANTS, dem_prepare_linear, dem_force_linear, note_landing, NULL};
DEM_KERNEL(landing_kernel, landing_law, DEM_LINEAR)
static void test_hooks_after_a_flight(void **state) {
    (void)state;
    const double d[2] = {0.004, 0.004}, centre[6] = {0, 0, 0, 0.002, 0, 0.001}, high[3] = {0, 0, 0.0123},
                 aside[3] = {0.05, 0, 0.0171};
    dem_world w;
    dem_clump clump;
    landing l = {0, 0.0};
    lossless(&w, 0.5);
    w.user = &l;
    assert_int_equal(dem_set_gravity(&w, v3(0, 0, -9.81)), DEM_OK);
    assert_int_equal(dem_make_clump(2, centre, d, &clump), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 1, high, d, 0, 0), DEM_OK);
    assert_int_equal(dem_add_clumps(&w, 1, &clump, aside, NULL, NULL, 0, 0), DEM_OK);
    dem_add_plane(&w, 0, v3(0, 0, 0), v3(0, 0, 1));
    assert_int_equal(dem_run_law(&w, 0.4, &landing_kernel), DEM_OK);
    assert_true(l.seen > 8);
    assert_true(l.worst < 2.0 * w.def.dt); /* what is crossed in a step at 1 m/s */
    dem_free(&w);
}

static int ended[3]; /* by itself, particle taken out, wall gone */
static void note_end(dem_world *world, int32_t k, void *user) {
    (void)user;
    const dem_contact_info c = dem_get_contact(world, k);
    const int gone = world->alive[c.i] != DEM_PRESENT || (c.j >= 0 && world->alive[c.j] != DEM_PRESENT);
    ended[gone ? 1 : c.j < 0 && !dem_wall_acts(world, -1 - (int)c.j, c.i) ? 2 : 0]++;
}
static const dem_law noting_law = {
    "linear, notes its ends", 1, 0, 0, 0, DEM_LINEAR_CONSTANTS, dem_prepare_linear, dem_force_linear, NULL, note_end};
DEM_KERNEL(noting, noting_law, DEM_LINEAR)

static void test_why_contacts_end(void **state) {
    (void)state;
    /* Bounces off; removed; removed by region; passes an exit; wall disabled; wall for others. */
    for (int k = 0; k < 6; k++) {
        dem_world w;
        const dem_region all = dem_box_region(v3(-1, -1, -1), v3(1, 1, 1));
        lossless(&w, 0.0);
        const int plane = floor_of(&w);
        if (k == 3) dem_add_exit(&w, v3(0, 0, radius), v3(0, 0, -1)); /* for what is above */
        put(&w, 0, 0, k == 3 ? radius - 2e-4 : radius - 1e-4);
        ended[0] = ended[1] = ended[2] = 0;
        assert_int_equal(dem_run_law(&w, 1e-5, &noting), DEM_OK);
        assert_int_equal(dem_wall_acts(&w, plane, 0), 1);
        if (k == 1) assert_int_equal(dem_remove(&w, 0), DEM_OK);
        if (k == 2) assert_int_equal(dem_remove_region(&w, &all), 1);
        if (k == 3) dem_set_motion(&w, 0, v3(0, 0, 210.0), v3(0, 0, 0)); /* out before the contact ends */
        if (k == 4) dem_enable_wall(&w, plane, 0);
        if (k == 5) dem_set_wall_groups(&w, plane, ~1u);
        assert_int_equal(dem_run_law(&w, k == 3 ? 1e-6 : 0.01, &noting), DEM_OK);
        const int why = k == 0 ? 0 : k < 4 ? 1 : 2;
        for (int q = 0; q < 3; q++) assert_int_equal(ended[q], q == why);
        dem_free(&w);
    }
    assert_int_equal(dem_wall_acts(NULL, 0, 0), 0);
}

static void test_step_ratio(void **state) {
    (void)state;
    dem_world w;
    lossless(&w, 0.0);
    floor_of(&w);
    assert_true(w.step_ratio == 0.0);
    put(&w, 0, 0, 1.0);
    put(&w, 0, 0, 2.0);
    run(&w, 1e-5, DEM_LINEAR);
    const double stable = 2.0 * sqrt(0.5 * dem_mass(&w, 0) / stiffness); /* of the pair */
    near_relative(w.step_ratio, 1e-6 / stable, 1e-9, "ratio");
    assert_int_equal(dem_set_time_step(&w, 2.0 * stable), DEM_OK);
    run(&w, 10.0 * stable, DEM_LINEAR);
    near_relative(w.step_ratio, 2.0, 1e-9, "too long");
    dem_pair_def p = *dem_pair(&w.def, 0, 0);
    p.stiffness *= 0.01;
    assert_int_equal(dem_set_pair(&w, 0, 0, &p), DEM_OK);
    run(&w, 10.0 * stable, DEM_LINEAR);
    near_relative(w.step_ratio, 0.2, 1e-9, "softer");
    run(&w, 10.0 * stable, DEM_LINEAR);
    near_relative(w.step_ratio, 0.2, 1e-9, "as before");
    dem_free(&w);
}

/* A tangential spring that the caller stretches between runs is in the books as added. */
static void test_states_set_by_the_caller(void **state) {
    (void)state;
    dem_world w;
    const double stretched[DEM_STATE_MAX] = {1e-5, 2e-5, 0.0};
    dem_def def = dem_default_def();
    dem_add_material(&def, 2500.0, 1e7, 0.2);
    dem_pair(&def, 0, 0)->stiffness = 2e3, dem_pair(&def, 0, 0)->friction = 5.0;
    def.dt = 5e-6;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    dem_add_plane(&w, 0, v3(0, 0, 0), v3(0, 0, 1));
    const double at[3] = {0, 0, 0.0049}, d = 0.01;
    assert_int_equal(dem_add_spheres(&w, 1, at, &d, 0, 0), DEM_OK);
    run(&w, 1e-4, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY);
    const double error = dem_energy(&w).error, added = dem_energy(&w).added;
    dem_set_contact_state(&w, 0, stretched);
    run(&w, 1e-4, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY);
    const double stored = 0.5 * 2e3 * 2.0 / 7.0 * 5e-10;
    near_relative(dem_energy(&w).added - added, stored, 0.05, "added");
    near_absolute(dem_energy(&w).error, error, 1e-3 * stored, "ledger");
    dem_free(&w);
}

/* ---- materials that touch and whose pair nobody set ---- */

/* Two materials, of spheres and of walls, with no pair of the two. */
static void two_materials(dem_world *w, dem_def *def) {
    *def = dem_default_def();
    def->dt = 1e-5;
    dem_add_material(def, 2500.0, 1e7, 0.25), dem_add_material(def, 7800.0, 1e9, 0.3),
        dem_add_material(def, 1000.0, 1e6, 0.4);
    assert_int_equal(dem_init(w, def, NULL), DEM_OK);
}
static void sphere_at(dem_world *w, double x, double z, int material) {
    const double c[3] = {x, 0, z}, d = 0.01;
    assert_int_equal(dem_add_spheres(w, 1, c, &d, material, 0), DEM_OK);
}
static void refused(dem_world *w, int features, int low, int high) {
    const int64_t step = w->step, contacts = dem_contact_count(w);
    for (int k = 0; k < 2; k++) { /* and again, as long as nobody sets it */
        assert_int_equal(dem_run(w, 0.2, features), DEM_PAIR_NOT_SET);
        assert_int_equal(w->failed_pair[0], low), assert_int_equal(w->failed_pair[1], high);
        assert_true(k == 0 ? w->step >= step : dem_contact_count(w) == contacts);
    }
}

static void test_unset_pairs_are_refused(void **state) {
    (void)state;
    static const int features[] = {DEM_LINEAR, DEM_LINEAR | DEM_FRICTION, DEM_HERTZ | DEM_FRICTION | DEM_ENERGY};
    const double heap[6] = {0, 0, 0.02, 0.004, 0, 0.02}, diameters[2] = {0.01, 0.01};
    for (int k = 0; k < 3; k++) {
        for (int skip = 0; skip <= DEM_SKIP_ALL; skip += DEM_SKIP_ALL) {
            dem_world w;
            dem_def def;
            two_materials(&w, &def); /* a plane */
            w.def.skip = skip;
            dem_add_plane(&w, 2, v3(0, 0, 0), v3(0, 0, 1));
            sphere_at(&w, 0, 0.02, 1);
            refused(&w, features[k], 1, 2);
            near_absolute(dem_position(&w, 0).z, 0.005, 2e-5, "where it touches");
            dem_free(&w);
            two_materials(&w, &def); /* two spheres, there from the start, or one that falls */
            dem_add_spheres(&w, 1, heap, diameters, 2, 0), dem_add_spheres(&w, 1, heap + 3, diameters, 0, 0);
            refused(&w, features[k], 0, 2);
            assert_int_equal(w.step, 0);
            dem_free(&w);
            two_materials(&w, &def);
            sphere_at(&w, 0, 0.02, 2), sphere_at(&w, 0, 0.04, 0);
            dem_set_motion(&w, 1, v3(0, 0, -1.0), v3(0, 0, 0));
            refused(&w, features[k], 0, 2);
            dem_free(&w);
        }
    }
}

/* A cylinder, a cone, a screen, a mesh; a clump, a brick; and exits, which nothing touches. */
static void test_unset_pairs_of_every_shape(void **state) {
    (void)state;
    for (int shape = 0; shape < 7; shape++) {
        dem_world w;
        dem_def def;
        two_materials(&w, &def);
        const double low[3] = {-0.1, -0.1, 0.0}, high[3] = {0.1, 0.1, 0.1}, at[3] = {0.05, 0.05, 0.05}, d = 0.01;
        dem_screen screen = dem_default_screen();
        dem_cone cone = dem_default_cone();
        screen.aperture = 0.004;
        cone.low_radius = 0.001;
        switch (shape) {
        case 0: dem_add_cylinder(&w, 1, v3(0.05, 0.05, 0), v3(1, 0, 0), 0.04, 1); break;
        case 1: dem_add_cone(&w, 1, &cone); break;
        case 2: dem_add_screen(&w, 1, &screen); break;
        case 3: dem_add_box(&w, 1, v3(low[0], low[1], low[2]), v3(high[0], high[1], high[2])); break;
        default: dem_add_plane(&w, 1, v3(0, 0, 0), v3(0, 0, 1)); break;
        }
        if (shape == 5) {
            const double two[6] = {0, 0, 0, 0.004, 0, 0}, diameters[2] = {0.01, 0.01};
            dem_clump clump;
            assert_int_equal(dem_make_clump(2, two, diameters, &clump), DEM_OK);
            assert_int_equal(dem_add_clumps(&w, 1, &clump, at, NULL, NULL, 0, 0), DEM_OK);
        } else {
            const double centre[3] = {shape == 1 ? 0.0 : at[0], shape == 1 ? 0.0 : at[1], at[2]};
            assert_int_equal(dem_add_spheres(&w, 1, centre, &d, shape == 6 ? 1 : 0, 0), DEM_OK);
        }
        if (shape == 6) run(&w, 0.3, DEM_LINEAR | DEM_FRICTION); /* alike: the defaults */
        else refused(&w, DEM_LINEAR | DEM_FRICTION, 0, 1);
        dem_free(&w);
    }
}

/* A sphere, a clump or a brick of one material falls on a sphere, a clump or a brick of another that is fixed or free,
   by itself, with a link between them, or in a force field. */
DEM_INLINE dem_vec no_force(const dem_force_point *at) { return dem_vec3(0.0 * at->mass, 0.0, 0.0); }
DEM_FORCE_FIELD(no_field, no_force)
DEM_INLINE void weak_force(const dem_contact *c, double *state, dem_response *r) {
    (void)state, r->normal = -1e-3 * c->gap;
}
static const dem_law weak_link = {"weak", 1, 0, 0, 0, 0, NULL, weak_force, NULL, NULL};
DEM_LINK_KERNEL(weak_kernel, weak_link)

static void body_at(dem_world *w, int shape, double z, int material) {
    const double at[3] = {0, 0, z}, two[6] = {0, 0, 0, 0.004, 0, 0}, diameters[2] = {0.01, 0.01};
    dem_clump clump;
    dem_convex brick;
    if (shape == 0) sphere_at(w, 0, z, material);
    if (shape == 1) {
        assert_int_equal(dem_make_clump(2, two, diameters, &clump), DEM_OK);
        assert_int_equal(dem_add_clumps(w, 1, &clump, at, NULL, NULL, material, 0), DEM_OK);
    }
    if (shape == 2) {
        assert_int_equal(dem_make_brick(&brick, v3(0.01, 0.01, 0.01), 0.1, NULL), DEM_OK);
        assert_int_equal(dem_add_convex(w, dem_add_shape(w, &brick), 1, at, NULL, material, 0), DEM_OK);
    }
}
static void test_unset_pairs_of_bodies(void **state) {
    (void)state;
    for (int k = 0; k < 36; k++) {
        const int upper = k % 3, lower = k / 3 % 3, way = k / 9; /* fixed, free, linked, in a field */
        const int features = DEM_LINEAR | DEM_FRICTION;
        dem_world w;
        dem_def def;
        two_materials(&w, &def);
        body_at(&w, lower, 0.0, 2);
        const ptrdiff_t second = w.count;
        body_at(&w, upper, 0.012, 0);
        dem_force_field f = dem_default_force_field(no_field, NULL);
        if (way != 1) assert_int_equal(dem_fix(&w, 0, 1), DEM_OK);
        if (way == 2 && (upper == 2 || lower == 2)) { /* polyhedra have no links */
            dem_free(&w);
            continue;
        }
        if (way == 2) assert_int_equal(dem_set_links(&w, &weak_kernel, 1e-4, 1e-6), DEM_OK);
        if (way == 2) assert_int_equal(dem_add_link(&w, 0, second, 0, NULL), DEM_OK);
        if (way == 3) assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        assert_int_equal(dem_set_motion(&w, second, v3(0, 0, -0.2), v3(0, 0, 0)), DEM_OK);
        refused(&w, features, 0, 2);
        dem_free(&w);
    }
    dem_world w; /* a feed that falls on a wall of spheres' own kind, and on another */
    dem_def def;
    two_materials(&w, &def);
    dem_add_plane(&w, 1, v3(0, 0, 0), v3(0, 0, 1)), dem_add_plane(&w, 2, v3(0, 0, -0.001), v3(0, 0, 1));
    assert_int_equal(dem_set_wall_groups(&w, 1, 2u), DEM_OK); /* for group 1 only */
    assert_int_equal(dem_set_wall_groups(&w, 0, 1u), DEM_OK);
    dem_feed feed = dem_default_feed();
    feed.region = dem_box_region(v3(0, 0, 0.01), v3(0.02, 0.02, 0.02)), feed.material = 1;
    assert_int_equal(dem_feed_number(&w, &feed, 100.0, 0.05), DEM_OK);
    run(&w, 0.1, DEM_LINEAR); /* alike */
    feed.group = 1;
    assert_int_equal(dem_feed_number(&w, &feed, 100.0, 0.05), DEM_OK);
    refused(&w, DEM_LINEAR, 1, 2);
    dem_free(&w);
}

/* Whoever sets the pair goes on, with the bits of a run that had it from the start; saves and loads know
   what was set. */
static void test_pair_set_later(void **state) {
    (void)state;
    static char saved[200000];
    uint64_t hash[3];
    for (int way = 0; way < 3; way++) {
        dem_world w;
        dem_def def;
        two_materials(&w, &def);
        dem_free(&w);
        if (way == 0) dem_pair(&def, 0, 2)->restitution = 0.5;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        dem_add_plane(&w, 2, v3(0, 0, 0), v3(0, 0, 1));
        sphere_at(&w, 0, 0.02, 0);
        if (way > 0) assert_int_equal(dem_run(&w, 0.2, DEM_LINEAR | DEM_FRICTION), DEM_PAIR_NOT_SET);
        if (way == 2) {
            const size_t bytes = dem_save(&w, saved, sizeof saved);
            assert_true(bytes <= sizeof saved);
            dem_free(&w);
            assert_int_equal(dem_load(&w, saved, bytes, NULL), DEM_OK);
            assert_int_equal(dem_run(&w, 0.2 - w.time, DEM_LINEAR | DEM_FRICTION), DEM_PAIR_NOT_SET);
        }
        dem_pair_def pair = def.pair[0][2];
        pair.restitution = 0.5, pair.given = 0;
        if (way > 0) assert_int_equal(dem_set_pair(&w, 2, 0, &pair), DEM_OK);
        run(&w, 0.2 - w.time, DEM_LINEAR | DEM_FRICTION);
        hash[way] = dem_hash(&w);
        dem_free(&w);
    }
    assert_true(hash[0] == hash[1] && hash[0] == hash[2]);
    dem_def def = dem_default_def();
    assert_int_equal(def.pair[0][1].given, 0);
    dem_pair(&def, 1, 0);
    assert_int_equal(def.pair[0][1].given, 1);
}

/* ---- fixed particles ---- */

enum { BALLS = DEM_LINEAR | DEM_FRICTION | DEM_ENERGY };

static void some_world(dem_world *w, double e, double gravity) {
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 2500.0, 1e7, 0.25);
    dem_pair_def *p = dem_pair(&def, m, m);
    p->stiffness = 1e4, p->restitution = e, p->friction = 0.5;
    def.dt = 2e-6, def.gravity = v3(0, 0, gravity);
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
}
static void ball(dem_world *w, double x, double y, double z, double d) {
    const double c[3] = {x, y, z};
    assert_int_equal(dem_add_spheres(w, 1, c, &d, 0, 0), DEM_OK);
}

static void add_brick(dem_world *w, dem_vec lengths, const double *centre) {
    dem_convex shape;
    assert_int_equal(dem_make_brick(&shape, lengths, 0.03, NULL), DEM_OK);
    assert_int_equal(dem_add_convex(w, dem_add_shape(w, &shape), 1, centre, NULL, 0, 0), DEM_OK);
}

/* An impact on a fixed sphere is that on a wall of the same shape; the impulse on it is what the other has lost. */
static void test_fixed_sphere_is_a_wall(void **state) {
    (void)state;
    static const int features[] = {DEM_LINEAR | DEM_ENERGY, BALLS, DEM_HERTZ | DEM_FRICTION | DEM_ENERGY};
    for (int k = 0; k < 3; k++) {
        dem_vec v[2], spin[2], force, torque, impulse;
        double mass = 0.0;
        for (int is_wall = 0; is_wall < 2; is_wall++) {
            dem_world w;
            some_world(&w, 0.6, 0.0);
            ball(&w, 0.004, 0, 0.012, 0.01);
            dem_set_motion(&w, 0, v3(0.1, 0.2, -1.0), v3(5, 10, 15));
            if (is_wall) assert_true(dem_add_sphere_wall(&w, 0, v3(0, 0, 0), 0.005, 0) >= 0);
            else ball(&w, 0, 0, 0, 0.01), assert_int_equal(dem_fix(&w, 1, 1), DEM_OK);
            run(&w, 0.01, features[k]);
            v[is_wall] = dem_velocity(&w, 0), spin[is_wall] = dem_spin(&w, 0), mass = dem_mass(&w, 0);
            near_absolute(dem_energy(&w).error, 0.0, 5e-5 * 0.5 * mass, "ledger");
            if (!is_wall) {
                assert_int_equal(dem_get_fixed_force(&w, 1, &force, &torque, &impulse), DEM_OK);
                const dem_vec x = dem_position(&w, 1), u = dem_velocity(&w, 1);
                assert_true(x.x == 0.0 && x.y == 0.0 && x.z == 0.0 && u.x == 0.0 && u.y == 0.0 && u.z == 0.0);
            }
            dem_free(&w);
        }
        /* friction acts at the middle of the overlap of two spheres, and at the surface of a wall */
        const double close = k == 0 ? 1e-6 : 0.03, turned = k == 0 ? 1e-6 : 0.1;
        near_absolute(v[0].x, v[1].x, close, "vx"), near_absolute(v[0].y, v[1].y, close, "vy"),
            near_absolute(v[0].z, v[1].z, close, "vz");
        near_absolute(spin[0].x, spin[1].x, turned * length_of(spin[1]), "spin x");
        near_absolute(spin[0].y, spin[1].y, turned * length_of(spin[1]), "spin y");
        near_absolute(impulse.z, -mass * (v[0].z + 1.0), 1e-10, "impulse");
        near_absolute(impulse.x, -mass * (v[0].x - 0.1), 1e-10, "impulse");
        assert_true(force.x == 0.0 && force.y == 0.0 && force.z == 0.0);
    }
}

/* A heap on a floor of fixed spheres that overlap and reach through a wall: no speed, the weight on them, the same bits
   whatever is skipped and however often it is saved. */
static void test_heap_on_fixed_spheres(void **state) {
    (void)state;
    static char saved[2000000];
    uint64_t hash[4];
    for (int way = 0; way < 4; way++) {
        dem_world w;
        some_world(&w, 0.3, -9.81);
        w.def.skip = way == 1 ? 0 : DEM_SKIP_ALL, w.def.threads = way == 2 ? 3 : 1;
        dem_add_plane(&w, 0, v3(0, 0, -0.001), v3(0, 0, 1));
        dem_add_cylinder(&w, 0, v3(0, 0, 0), v3(0, 0, 1), 0.022, 1);
        for (int k = 0; k < 36; k++) ball(&w, 0.008 * (k % 6) - 0.02, 0.008 * (k / 6) - 0.02, 0.0, 0.01);
        for (int i = 0; i < 36; i++) assert_int_equal(dem_fix(&w, i, 1), DEM_OK);
        for (int k = 0; k < 27; k++)
            ball(&w, 0.011 * (k % 3) - 0.011, 0.011 * (k / 3 % 3) - 0.0107, 0.02 + 0.011 * (k / 9), 0.009);
        for (int part = 0; part < 4; part++) {
            run(&w, 0.1, BALLS);
            if (way != 3) continue;
            const size_t bytes = dem_save(&w, saved, sizeof saved);
            assert_true(bytes <= sizeof saved);
            dem_free(&w);
            assert_int_equal(dem_load(&w, saved, bytes, NULL), DEM_OK);
            assert_true(dem_is_fixed(&w, 35) && !dem_is_fixed(&w, 36));
        }
        hash[way] = dem_hash(&w);
        double carried = 0.0, weight = 0.0, walls = w.wall[0].force.z + w.wall[1].force.z, speed = 0.0;
        for (ptrdiff_t i = 0; i < w.count; i++) {
            dem_vec force, torque, impulse;
            const int fixed = i < 36;
            assert_int_equal(dem_get_fixed_force(&w, i, &force, &torque, &impulse), fixed ? DEM_OK : DEM_BAD_ARGUMENT);
            if (fixed) carried -= force.z, assert_true(dem_position(&w, i).z == 0.0);
            else weight += 9.81 * dem_mass(&w, i), speed = fmax(speed, fabs(dem_velocity(&w, i).z));
        }
        if (way == 0) near_relative(carried - walls, weight, 0.02, "weight"), assert_true(speed < 1e-3);
        for (ptrdiff_t k = 0; k < dem_contact_count(&w); k++) { /* none of fixed ones alone */
            const dem_contact_info c = dem_get_contact(&w, k);
            assert_false(c.i < 36 && c.j < 36);
        }
        near_absolute(dem_energy(&w).error, 0.0, 1e-4 * dem_energy(&w).released, "ledger");
        dem_free(&w);
    }
    for (int way = 1; way < 4; way++) assert_true(hash[way] == hash[0]);
}

/* It moves as it is told, through a periodic box, against a load, past an exit and a wall; what it does to
   others is work. */
static void test_fixed_spheres_that_move(void **state) {
    (void)state;
    dem_world w;
    some_world(&w, 0.5, -9.81);
    w.def.dt = 2e-6;
    dem_free(&w);
    dem_def def = dem_default_def();
    dem_add_material(&def, 2500.0, 1e7, 0.25);
    dem_pair(&def, 0, 0)->stiffness = 1e4, def.dt = 2e-6;
    def.periodic[0] = 1, def.low.x = -0.05, def.high.x = 0.05, def.gravity.x = 1.0;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    ball(&w, -0.03, 0, 0, 0.01), ball(&w, 0.0, 0.001, 0.008, 0.01), ball(&w, 0.03, 0, 0.03, 0.01);
    assert_int_equal(dem_fix(&w, 0, 1), DEM_OK), assert_int_equal(dem_fix(&w, 2, 1), DEM_OK);
    dem_add_exit(&w, v3(0, 0, 0.05), v3(0, 0, -1)), dem_add_plane(&w, 0, v3(0, 0, 0.07), v3(0, 0, -1));
    assert_int_equal(dem_set_load(&w, 0, v3(1, 2, 3), v3(1, 0, 0)), DEM_OK);
    assert_int_equal(dem_set_motion(&w, 0, v3(0.5, 0, 0), v3(0, 40, 0)), DEM_OK);
    assert_int_equal(dem_set_motion(&w, 2, v3(0, 0, 1), v3(0, 0, 0)), DEM_OK);
    run(&w, 0.1, BALLS);
    assert_int_equal(dem_set_gravity(&w, v3(0, 0, -2)), DEM_OK);
    run(&w, 0.1, BALLS);
    near_absolute(dem_position(&w, 0).x, -0.03 + 0.1 - 0.1, 1e-12, "x"),
        near_absolute(dem_position(&w, 0).z, 0.0, 0.0, "z");
    near_absolute(dem_position(&w, 2).z, 0.03 + 0.2, 1e-12, "past an exit and a wall");
    assert_true(dem_spin(&w, 0).y == 40.0 && w.passed_total == 0 && dem_energy(&w).external_work > 0.0);
    const dem_energy_ledger e = dem_energy(&w);
    near_absolute(e.error, 0.0, 2e-5 * e.external_work, "ledger");
    assert_int_equal(dem_fix(&w, 0, 0), DEM_OK); /* free again, with its speed and its load */
    run(&w, 1e-3, BALLS);
    near_absolute(dem_velocity(&w, 0).z, (3.0 / dem_mass(&w, 0) - 2.0) * 1e-3, 1e-9, "free");
    near_absolute(dem_velocity(&w, 0).x, 0.5 + 1.0 / dem_mass(&w, 0) * 1e-3, 1e-9, "free");
    near_absolute(dem_energy(&w).error, 0.0, 2e-5 * fabs(dem_energy(&w).added), "ledger");
    dem_free(&w);
}

/* Clumps and polyhedra are fixed as a whole. */
static void test_fixed_bodies(void **state) {
    (void)state;
    const double two[6] = {0, 0, 0, 0.008, 0, 0}, diameters[2] = {0.01, 0.01}, at[3] = {0, 0, 0},
                 above[3] = {0.002, 0, 0.011};
    for (int shape = 0; shape < 2; shape++) {
        dem_world w;
        dem_clump clump;
        dem_vec force, torque, impulse;
        some_world(&w, 0.5, -9.81);
        if (shape == 0) {
            assert_int_equal(dem_make_clump(2, two, diameters, &clump), DEM_OK);
            assert_int_equal(dem_add_clumps(&w, 1, &clump, at, NULL, NULL, 0, 0), DEM_OK);
        } else {
            add_brick(&w, v3(0.008, 0.008, 0.008), at);
        }
        const ptrdiff_t parts = w.count;
        assert_int_equal(dem_fix(&w, parts - 1, 1), DEM_OK);
        assert_true(dem_is_fixed(&w, 0));
        /* Bodies don't spin while fixed. */
        assert_int_equal(dem_set_motion(&w, 0, v3(0, 0, 0), v3(0, 0, 1)), DEM_BAD_ARGUMENT);
        ball(&w, above[0], above[1], above[2], 0.01);
        run(&w, 0.5, BALLS);
        const dem_body now = dem_get_body(&w, 0);
        near_absolute(length_of(now.position), 0.0, 0.0, "place");
        near_absolute(length_of(now.velocity) + length_of(now.spin), 0.0, 0.0, "motion");
        assert_int_equal(dem_get_fixed_force(&w, 0, &force, &torque, &impulse), DEM_OK);
        if (shape == 1) near_relative(-force.z, 9.81 * dem_mass(&w, parts), 1e-3, "the ball rests on the brick");
        near_absolute(dem_energy(&w).error, 0.0, 1e-4 * dem_energy(&w).released, "ledger");
        assert_int_equal(dem_set_motion(&w, 0, v3(0.1, 0, 0), v3(0, 0, 0)), DEM_OK);
        run(&w, 0.1, BALLS);
        near_absolute(dem_position(&w, 0).x, dem_get_body(&w, 0).position.x + (shape ? 0.0 : -0.004), 1e-9, "as one");
        near_absolute(dem_get_body(&w, 0).position.x, 0.01, 1e-12, "moved");
        assert_int_equal(dem_fix(&w, 0, 0), DEM_OK);
        run(&w, 0.1, BALLS);
        assert_true(dem_get_body(&w, 0).position.z < -0.01);
        dem_free(&w);
    }
}

static void test_fixing_refused(void **state) {
    (void)state;
    dem_world w;
    dem_vec a, b, c;
    some_world(&w, 0.5, -9.81);
    ball(&w, 0, 0, 0, 0.01), ball(&w, 0, 0, 0.1, 0.01);
    assert_int_equal(dem_fix(NULL, 0, 1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fix(&w, -1, 1), DEM_BAD_ARGUMENT), assert_int_equal(dem_fix(&w, 2, 1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fix(&w, 0, 2), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_get_fixed_force(&w, 0, &a, &b, &c), DEM_BAD_ARGUMENT);
    assert_true(isnan(a.x) && !dem_is_fixed(&w, 0) && !dem_is_fixed(NULL, 0));
    assert_int_equal(dem_get_fixed_force(&w, 0, NULL, &b, &c), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fix(&w, 0, 1), DEM_OK), assert_int_equal(dem_fix(&w, 0, 1), DEM_OK);
    const dem_advice with = dem_advise(&w, DEM_LINEAR, 1.0);
    const double k = 1e4, m = dem_mass(&w, 1);
    near_relative(with.contact, dem_contact_time(k, 0.5 * m, dem_damping_ratio(0.5, DEM_CLIPPED), DEM_CLIPPED), 1e-9,
                  "two free ones");
    dem_remove(&w, 0);
    assert_int_equal(dem_fix(&w, 0, 1), DEM_BAD_ARGUMENT);
    run(&w, 0.1, BALLS);
    near_absolute(dem_energy(&w).error, 0.0, 1e-12, "ledger");
    dem_free(&w);
}

/* The step's report knows heavy and light ones, parts of bodies and laws of one's own. */
static double stiff_prepare(const dem_birth *birth, double *constants) {
    return 100.0 * dem_prepare_linear(birth, constants);
}
static const dem_law stiff_law = {"stiff",          1,    0,   0, 0, DEM_LINEAR_CONSTANTS, stiff_prepare,
                                  dem_force_linear, NULL, NULL};
DEM_KERNEL(stiff_kernel, stiff_law, DEM_LINEAR)

static void test_step_ratio_of_all_kinds(void **state) {
    (void)state;
    const double at[3] = {0, 0, 0.05};
    dem_world w;
    some_world(&w, 1.0, -9.81); /* a law of one's own, 100 times as stiff */
    dem_add_plane(&w, 0, v3(0, 0, 0), v3(0, 0, 1));
    ball(&w, 0, 0, 0.0049, 0.01), ball(&w, 0.03, 0, 0.1, 0.01);
    assert_int_equal(dem_run_law(&w, 1e-5, &stiff_kernel), DEM_OK);
    near_relative(w.step_ratio, 0.5 * w.def.dt * sqrt(1e6 / dem_mass(&w, 0)), 1e-9, "own law");
    dem_free(&w);
    some_world(&w, 1.0, -9.81); /* a thin plate, lighter than the sphere about it, and turning aside */
    add_brick(&w, v3(0.008, 0.008, 0.001), at);
    dem_add_plane(&w, 0, v3(0, 0, 0), v3(0, 0, 1));
    run(&w, 1e-5, DEM_LINEAR | DEM_FRICTION);
    assert_true(w.step_ratio > 0.5 * w.def.dt * sqrt(1e4 / (0.5 * dem_get_body(&w, 0).mass)));
    const double before = w.step_ratio;
    run(&w, 0.2, DEM_LINEAR | DEM_FRICTION);
    near_relative(w.step_ratio, before, 1e-12, "no contact is worse than foreseen");
    dem_free(&w);
    some_world(&w, 1.0, -9.81); /* a grain between boulders */
    ball(&w, 0, 0, 0, 1.0), ball(&w, 0, 0, 2, 0.001), ball(&w, 0, 0, 4, 1.0);
    run(&w, 1e-5, DEM_LINEAR);
    near_relative(w.step_ratio, 0.5 * w.def.dt * sqrt(1e4 / (0.5 * dem_mass(&w, 1))), 1e-9, "the lightest pair");
    dem_free(&w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fixed_sphere_is_a_wall),
        cmocka_unit_test(test_heap_on_fixed_spheres),
        cmocka_unit_test(test_fixed_spheres_that_move),
        cmocka_unit_test(test_fixed_bodies),
        cmocka_unit_test(test_fixing_refused),
        cmocka_unit_test(test_step_ratio_of_all_kinds),
        cmocka_unit_test(test_states_set_by_the_caller),
        cmocka_unit_test(test_unset_pairs_are_refused),
        cmocka_unit_test(test_unset_pairs_of_every_shape),
        cmocka_unit_test(test_unset_pairs_of_bodies),
        cmocka_unit_test(test_pair_set_later),
        cmocka_unit_test(test_callers_acts_are_booked),
        cmocka_unit_test(test_size_of_the_bookings),
        cmocka_unit_test(test_set_gravity),
        cmocka_unit_test(test_set_pair),
        cmocka_unit_test(test_set_time_step),
        cmocka_unit_test(test_records_are_taken),
        cmocka_unit_test(test_records_are_saved),
        cmocka_unit_test(test_no_subnormal_numbers),
        cmocka_unit_test(test_no_subnormal_walls),
        cmocka_unit_test(test_creep_of_the_default_law),
        cmocka_unit_test(test_fill_around_solids),
        cmocka_unit_test(test_what_is_solid),
        cmocka_unit_test(test_inside_of_a_mesh),
        cmocka_unit_test(test_fill_a_mesh),
        cmocka_unit_test(test_walls_for_groups),
        cmocka_unit_test(test_normal_and_point),
        cmocka_unit_test(test_hooks_after_a_flight),
        cmocka_unit_test(test_why_contacts_end),
        cmocka_unit_test(test_step_ratio),
    };
    return cmocka_run_group_tests_name("faults", tests, NULL, NULL);
}
