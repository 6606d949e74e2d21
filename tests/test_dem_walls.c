/* dem.h: cone, sphere, box and mesh walls, the STL reader, prescribed, force- and torque-controlled walls, belts. */
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
#include "failing_allocator.h"

static void near_vec(dem_vec got, dem_vec wanted, double tolerance, const char *what) {
    near_absolute(got.x, wanted.x, tolerance, what), near_absolute(got.y, wanted.y, tolerance, what),
        near_absolute(got.z, wanted.z, tolerance, what);
}
static dem_vec v3(double x, double y, double z) { return dem_vec3(x, y, z); }
static const dem_vec zero = {0.0, 0.0, 0.0}, up = {0.0, 0.0, 1.0};
static const double nan_ = (double)NAN, inf = (double)INFINITY, radius = 2.5e-3, diameter = 5e-3;

static dem_def one_material(double e, double friction) {
    dem_def def = dem_default_def();
    int m = dem_add_material(&def, 2534.1, 1e8, 0.2);
    dem_pair(&def, m, m)->restitution = e, dem_pair(&def, m, m)->friction = friction;
    def.dt = 4e-6;
    return def;
}
static void start(dem_world *w, const dem_def *def) { assert_int_equal(dem_init(w, def, NULL), DEM_OK); }
static void add(dem_world *w, dem_vec at, double d) {
    assert_int_equal(dem_add_spheres(w, 1, &at.x, &d, 0, 0), DEM_OK);
}
static void move(dem_world *w, ptrdiff_t i, dem_vec v, dem_vec spin) {
    assert_int_equal(dem_set_motion(w, i, v, spin), DEM_OK);
}
static void run(dem_world *w, double t, int features) {
    dem_status status = dem_run(w, t, features);
    if (status != DEM_OK)
        fail_msg("%s, particle %lu, step %ld", dem_status_text(status), (unsigned long)w->failed_id, (long)w->step);
}
static int wall_index(int answer) {
    if (answer < 0) fail_msg("%s", dem_status_text((dem_status)-answer));
    return answer;
}

/* ---- meshes made here ---- */

typedef struct soup {
    double vertex[3 * 60000];
    int32_t triangle[3 * 120000];
    dem_mesh mesh;
} soup;

static dem_mesh *soup_mesh(soup *s) {
    s->mesh.vertex = s->vertex, s->mesh.triangle = s->triangle;
    return &s->mesh;
}
static int32_t corner(soup *s, dem_vec p) {
    double *to = &s->vertex[3 * s->mesh.vertices];
    to[0] = p.x, to[1] = p.y, to[2] = p.z;
    return (int32_t)s->mesh.vertices++;
}
static void facet(soup *s, int32_t a, int32_t b, int32_t c) {
    int32_t *to = &s->triangle[3 * s->mesh.triangles++];
    to[0] = a, to[1] = b, to[2] = c;
}
static soup *new_soup(void) {
    soup *s = (soup *)calloc(1, sizeof *s);
    assert_non_null(s);
    return s;
}
/* A plane patch of nx by ny irregular cells between origin, origin + u, origin + v, each cut along either diagonal. */
static void patch(soup *s, dem_vec origin, dem_vec u, dem_vec v, int nx, int ny, double jitter, scene_random *r) {
    const int32_t base = (int32_t)s->mesh.vertices;
    for (int b = 0; b <= ny; b++) {
        for (int a = 0; a <= nx; a++) {
            const int inner = a > 0 && b > 0 && a < nx && b < ny;
            const double x = (a + (inner ? scene_between(r, -jitter, jitter) : 0.0)) / nx,
                         y = (b + (inner ? scene_between(r, -jitter, jitter) : 0.0)) / ny;
            corner(s, dem__add(origin, dem__add(dem__scale(x, u), dem__scale(y, v))));
        }
    }
    for (int b = 0; b < ny; b++) {
        for (int a = 0; a < nx; a++) {
            const int32_t p = base + b * (nx + 1) + a, q = p + 1, t = p + nx + 1, z = t + 1;
            if (scene_uniform(r) < 0.5) facet(s, p, q, z), facet(s, p, z, t);
            else facet(s, p, q, t), facet(s, q, z, t);
        }
    }
}
/* A surface of revolution about z through points (radius, height). */
static void lathe(soup *s, int n_points, const double *rho, const double *height, int around) {
    const int32_t base = (int32_t)s->mesh.vertices;
    for (int k = 0; k < n_points; k++) {
        for (int a = 0; a < around; a++) {
            const double angle = 2.0 * RIDDLE_PI * a / around;
            corner(s, v3(rho[k] * cos(angle), rho[k] * sin(angle), height[k]));
        }
    }
    for (int k = 0; k + 1 < n_points; k++) {
        for (int a = 0; a < around; a++) {
            const int32_t p = base + k * around + a, q = base + k * around + (a + 1) % around, t = p + around,
                          z = q + around;
            facet(s, p, q, z), facet(s, p, z, t);
        }
    }
}

/* ---- geometry ---- */

static dem_vec on_segment(dem_vec a, dem_vec b, dem_vec p) {
    const dem_vec ab = dem__sub(b, a);
    double t = dem__dot(dem__sub(p, a), ab) / dem__dot(ab, ab);
    t = t < 0.0 ? 0.0 : (t > 1.0 ? 1.0 : t);
    return dem__add(a, dem__scale(t, ab));
}
/* By projection and the three edges: not the way of dem.h. */
static double to_triangle(dem_vec a, dem_vec b, dem_vec c, dem_vec p) {
    const dem_vec n = dem__cross(dem__sub(b, a), dem__sub(c, a));
    const double above = dem__dot(dem__sub(p, a), n) / dem__length(n);
    const dem_vec foot = dem__sub(p, dem__scale(above / dem__length(n), n));
    double least = HUGE_VAL;
    if (dem__dot(dem__cross(dem__sub(b, a), dem__sub(foot, a)), n) >= 0.0 &&
        dem__dot(dem__cross(dem__sub(c, b), dem__sub(foot, b)), n) >= 0.0 &&
        dem__dot(dem__cross(dem__sub(a, c), dem__sub(foot, c)), n) >= 0.0)
        return fabs(above);
    const dem_vec q[3] = {on_segment(a, b, p), on_segment(b, c, p), on_segment(c, a, p)};
    for (int k = 0; k < 3; k++) {
        const double d = dem__length(dem__sub(p, q[k]));
        least = d < least ? d : least;
    }
    return least;
}

static void test_mesh_distance(void **state) {
    (void)state;
    scene_random r = {5};
    for (int size = 1; size <= 3000; size = size * 3 + 1) {
        soup *s = new_soup();
        dem_world w;
        dem_def def = one_material(0.8, 0.0);
        for (int k = 0; k < size; k++) {
            const dem_vec at = scene_vector(&r, 1.0);
            const double edge = scene_uniform(&r) < 0.1 ? 1.0 : 0.05;
            const int32_t a = corner(s, at), b = corner(s, dem__add(at, scene_vector(&r, edge))),
                          c = corner(s, dem__add(at, scene_vector(&r, edge)));
            facet(s, a, b, c);
        }
        start(&w, &def);
        const int k = wall_index(dem_add_mesh(&w, 0, soup_mesh(s)));
        assert_int_equal(dem_rotate(&w, k, v3(0.3, 0, 0), v3(1, 2, 3), 1.0), DEM_OK);
        for (int q = 0; q < 60; q++) {
            const dem_vec p = scene_vector(&r, q < 30 ? 1.2 : 4.0);
            const double time = 0.1 * q;
            dem__touch touch[DEM__TOUCHES];
            double least = 0.0, wanted = HUGE_VAL;
            for (int t = 0; t < size; t++) {
                dem_vec c[3];
                for (int a = 0; a < 3; a++) {
                    const double *x = &s->vertex[3 * s->triangle[3 * t + a]];
                    c[a] = dem__add(v3(0.3, 0, 0), dem__rotated(v3(x[0] - 0.3, x[1], x[2]),
                                                                dem__scale(1.0 / sqrt(14.0), v3(1, 2, 3)), time));
                }
                const double d = to_triangle(c[0], c[1], c[2], p);
                wanted = d < wanted ? d : wanted;
            }
            dem__move_wall(&w.wall[k], time);
            assert_int_equal(dem__touch_wall(&w.wall[k], p, 0.01, 100.0, touch, &least) > 0, 1);
            near_absolute(least, wanted - 0.01, 1e-12, "gap to a mesh");
            near_absolute(touch[0].gap, least, 0.0, "nearest place");
            near_absolute(dem__length(touch[0].normal), 1.0, 1e-12, "normal");
            near_absolute(dem__touch_wall(&w.wall[k], p, 0.01, 0.5 * (wanted - 0.01), touch, &least), 0, 0,
                          "nothing within half");
            assert_true(least <= wanted - 0.01 && least >= 0.49 * (wanted - 0.01));
        }
        dem_free(&w);
        free(s);
    }
}

static void test_cone_and_sphere_distance(void **state) {
    (void)state;
    scene_random r = {11};
    dem_world w;
    dem_def def = one_material(0.8, 0.0);
    start(&w, &def);
    for (int n = 0; n < 12; n++) {
        dem_cone cone = dem_default_cone();
        cone.low = scene_vector(&r, 1.0), cone.high = scene_vector(&r, 1.0);
        cone.low_radius = n % 3 == 0 ? 0.0 : scene_between(&r, 0.05, 0.5),
        cone.high_radius = n % 3 == 2 ? cone.low_radius : scene_between(&r, 0.05, 0.5);
        const int k = wall_index(dem_add_cone(&w, 0, &cone));
        const dem_wall *wall = &w.wall[k];
        for (int q = 0; q < 40; q++) {
            const dem_vec p = scene_vector(&r, 1.5);
            dem__touch touch[DEM__TOUCHES];
            double least = 0.0, wanted = HUGE_VAL;
            const dem_vec axis = dem__sub(cone.high, cone.low);
            for (int a = 0; a < 1440; a++) { /* the nearest of many generatrices */
                const double angle = 2.0 * RIDDLE_PI * a / 1440;
                const dem_vec out =
                    dem__add(dem__scale(cos(angle), wall->axis[0]), dem__scale(sin(angle), wall->axis[1]));
                const dem_vec from = dem__add(cone.low, dem__scale(cone.low_radius, out)),
                              to = dem__add(dem__add(cone.low, axis), dem__scale(cone.high_radius, out));
                const double d = dem__length(dem__sub(p, on_segment(from, to, p)));
                wanted = d < wanted ? d : wanted;
            }
            assert_int_equal(dem__touch_wall(wall, p, 0.01, 10.0, touch, &least), 1);
            near_absolute(least, wanted - 0.01, 2e-5, "gap to a cone");
            const dem_vec foot = dem__sub(p, dem__scale(touch[0].gap + 0.01, touch[0].normal));
            double zero_there = 0.0;
            dem__touch_wall(wall, foot, 0.0, 10.0, touch, &zero_there);
            near_absolute(zero_there, 0.0, 1e-12, "the normal leads to the surface");
        }
        if (n % 6 == 5) dem_free(&w), start(&w, &def);
    }
    const int inside = wall_index(dem_add_sphere_wall(&w, 0, v3(1, 2, 3), 0.5, 1)),
              outside = wall_index(dem_add_sphere_wall(&w, 0, v3(1, 2, 3), 0.5, 0));
    dem__touch touch;
    double least;
    assert_int_equal(dem__touch_wall(&w.wall[inside], v3(1.3, 2, 3), 0.1, 1.0, &touch, &least), 1);
    near_absolute(touch.gap, 0.1, 1e-15, "inside"), near_vec(touch.normal, v3(-1, 0, 0), 1e-14, "inside");
    assert_int_equal(dem__touch_wall(&w.wall[outside], v3(1, 2, 2.3), 0.1, 1.0, &touch, &least), 1);
    near_absolute(touch.gap, 0.1, 1e-15, "outside"), near_vec(touch.normal, v3(0, 0, -1), 1e-14, "outside");
    /* the centre has no direction */
    assert_int_equal(dem__touch_wall(&w.wall[inside], v3(1, 2, 3), 0.1, 1.0, &touch, &least), 0);
    dem_free(&w);
}

/* The nearest point of a disc and of its rims, against points of the plane; and a cone as high as an atom. */
static void test_disc_distance(void **state) {
    (void)state;
    scene_random r = {17};
    dem_world w;
    dem_def def = one_material(0.8, 0.0);
    double worst = 0.0, turned = 0.0;
    start(&w, &def);
    for (int n = 0; n < 12; n++) {
        dem_disc disc = dem_default_disc();
        dem_cone cone = dem_default_cone();
        disc.centre = n % 3 ? scene_vector(&r, 1.0) : zero, disc.normal = scene_vector(&r, 2.0);
        disc.radius = scene_between(&r, 0.3, 0.6), disc.hole_radius = n % 2 ? 0.0 : scene_between(&r, 0.01, 0.29);
        const int k = wall_index(dem_add_disc(&w, 0, &disc));
        cone.low = disc.centre, cone.high = dem__plus(disc.centre, 1e-9, w.wall[k].axis[2]);
        cone.low_radius = disc.hole_radius, cone.high_radius = disc.radius;
        const int thin = wall_index(dem_add_cone(&w, 0, &cone));
        const dem_wall *wall = &w.wall[k], *flat = &w.wall[thin];
        for (int q = 0; q < 2000; q++) {
            const dem_vec p = dem__add(disc.centre, scene_vector(&r, q % 3 ? 0.8 : 0.05)), d = dem__sub(p, disc.centre);
            const double h = dem__dot(d, wall->axis[2]), rho = dem__length(dem__plus(d, -h, wall->axis[2]));
            const double off = rho > disc.radius        ? rho - disc.radius
                               : rho < disc.hole_radius ? disc.hole_radius - rho
                                                        : 0.0;
            dem__touch touch, other;
            double least;
            assert_int_equal(dem__touch_wall(wall, p, 0.01, 10.0, &touch, &least), 1);
            near_absolute(touch.gap, hypot(off, h) - 0.01, 1e-15, "gap to a disc");
            near_absolute(dem__length(touch.normal), 1.0, 1e-12, "normal");
            const dem_vec foot = dem__sub(p, dem__scale(touch.gap + 0.01, touch.normal)),
                          f = dem__sub(foot, disc.centre);
            near_absolute(dem__dot(f, wall->axis[2]), 0.0, 1e-13, "the normal leads to the disc");
            assert_true(dem__length(f) < disc.radius + 1e-13 && dem__length(f) > disc.hole_radius - 1e-13);
            assert_int_equal(dem__touch_wall(wall, p, 0.01, touch.gap, &other, &least), 0);
            assert_true(least == touch.gap);
            if (n % 3) continue; /* elsewhere its ends are too near each other to have a direction */
            dem__touch_wall(flat, p, 0.01, 10.0, &other, &least);
            worst = fabs(other.gap - touch.gap) > worst ? fabs(other.gap - touch.gap) : worst;
            if (touch.gap + 0.01 > 1e-3) turned = fmax(turned, dem__length(dem__sub(other.normal, touch.normal)));
        }
    }
    print_message("a disc and a cone of 1e-9 m: gaps differ by %.1e m, normals by %.1e\n", worst, turned);
    assert_true(worst <= 1.000001e-9 && worst > 1e-12 && turned < 2e-6);
    dem_free(&w);
}

/* On a bottom with a hole: a ball lies on it as on a plane, a smaller one falls through the hole, a larger one lies on
   its rim. From below a ball is stopped, too. */
static void test_disc_bottom(void **state) {
    (void)state;
    const double hole = 0.004, balls[3] = {diameter, 0.007, 0.01};
    for (int turn = 0; turn < 2; turn++) {
        const dem_vec normal = turn ? v3(0, -0.6, -0.8) : up, along = turn ? v3(1, 0, 0) : v3(0, 1, 0);
        dem_def def = one_material(0.4, 0.3);
        dem_disc disc = dem_default_disc();
        dem_world w, plane;
        dem_pair(&def, 0, 0)->rolling = 2e-4;
        def.gravity = dem__scale(-9.81, normal);
        disc.radius = 0.05, disc.hole_radius = hole, disc.normal = dem__scale(turn ? -3.0 : 3.0, normal);
        start(&w, &def), start(&plane, &def);
        wall_index(dem_add_disc(&w, 0, &disc)), wall_index(dem_add_plane(&plane, 0, zero, normal));
        const dem_vec beside = dem__plus(dem__scale(0.02, along), 0.004, normal);
        add(&w, beside, balls[0]), add(&plane, beside, balls[0]);
        add(&w, dem__scale(0.02, normal), balls[1]);
        run(&w, 0.4, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING),
            run(&plane, 0.4, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING);
        near_vec(dem_position(&w, 0), dem_position(&plane, 0), 1e-12, "as on a plane");
        near_absolute(dem__dot(w.wall[0].force, normal), -dem_mass(&w, 0) * 9.81, 1e-9, "its weight");
        near_vec(w.wall[0].torque, dem__cross(dem_position(&w, 0), w.wall[0].force), 1e-9, "its moment");
        assert_true(dem__dot(dem_position(&w, 1), normal) < -0.1);
        add(&w, dem__scale(0.006, normal), balls[2]);
        run(&w, 0.6, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING);
        near_absolute(dem__dot(dem_position(&w, 2), normal), sqrt(0.25 * balls[2] * balls[2] - hole * hole), 2e-6,
                      "on the rim of the hole");
        add(&w, dem__plus(dem__scale(-0.01, along), -0.02, normal), diameter); /* against the lower side */
        move(&w, 3, dem__scale(1.0, normal), zero);
        run(&w, 0.03, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING);
        assert_true(dem__dot(dem_velocity(&w, 3), normal) < -0.2 &&
                    dem__dot(dem_position(&w, 3), normal) < -0.5 * diameter);
        dem_free(&w), dem_free(&plane);
    }
}

/* ---- smooth surfaces are touched once ---- */

/* A ball on an incline, once of one plane and once of triangles. */
static void incline(double tangent, double friction, dem_vec spin, int cells, double drop) {
    const double angle = atan(tangent);
    const dem_vec down = v3(cos(angle), 0, -sin(angle)), across = v3(0, 1, 0), normal = v3(sin(angle), 0, cos(angle));
    scene_random r = {(uint64_t)cells};
    dem_world w[2];
    for (int k = 0; k < 2; k++) {
        dem_def def = one_material(0.6, friction);
        soup *s = new_soup();
        start(&w[k], &def);
        if (k == 0) dem_add_plane(&w[k], 0, zero, normal);
        else {
            patch(s, dem__add(dem__scale(-0.02, down), dem__scale(-0.05, across)), dem__scale(0.3, down),
                  dem__scale(0.1, across), cells, cells / 2 + 1, 0.3, &r);
            wall_index(dem_add_mesh(&w[k], 0, soup_mesh(s)));
        }
        add(&w[k], dem__scale(radius + drop, normal), diameter);
        move(&w[k], 0, v3(0.01, 0.03, 0.0), spin);
        free(s);
    }
    for (int n = 0; n < 25; n++) {
        for (int k = 0; k < 2; k++) run(&w[k], 0.01, DEM_LINEAR | DEM_FRICTION);
        assert_int_equal(dem_contact_count(&w[1]), dem_contact_count(&w[0]));
        near_vec(dem_position(&w[1], 0), dem_position(&w[0], 0), 1e-9, "position on triangles");
        near_vec(dem_velocity(&w[1], 0), dem_velocity(&w[0], 0), 1e-9, "velocity on triangles");
        for (int k = 0; k < 2; k++) dem__set_origin(&w[k], 0);
        near_vec(dem_spin(&w[1], 0), dem_spin(&w[0], 0), 1e-9 / radius, "spin on triangles");
    }
    assert_true(dem__dot(dem_position(&w[1], 0), down) > 0.04); /* over many facets */
    for (int k = 0; k < 2; k++) dem_free(&w[k]);
}
static void test_triangles_equal_the_plane(void **state) {
    (void)state;
    incline(0.4, 0.3, zero, 60, 0.0);            /* rolls */
    incline(1.5, 0.2, zero, 150, 1e-5);          /* slides, bounces */
    incline(0.3, 0.4, v3(30, 200, 50), 97, 0.0); /* spins, facets smaller than the ball */
    incline(0.3, 0.4, v3(0, 100, 0), 5, 1e-3);
}

/* Unwelded, doubled, turned over at random, in another frame and with slivers: the plane all the same. */
static void test_bad_triangles_equal_the_plane(void **state) {
    (void)state;
    scene_random r = {3};
    soup *s = new_soup(), *bad = new_soup();
    dem_world w[2];
    dem_def def = one_material(0.6, 0.3);
    patch(s, v3(-0.1, -0.1, 0), v3(0.2, 0, 0), v3(0, 0.2, 0), 30, 30, 0.3, &r);
    for (int k = 0; k < s->mesh.triangles; k++) {
        dem_vec c[3];
        for (int a = 0; a < 3; a++) {
            const double *x = &s->vertex[3 * s->triangle[3 * k + a]];
            c[a] = v3(x[0], x[1], x[2]);
        }
        for (int twice = 0; twice < (k % 5 == 0 ? 2 : 1); twice++) {
            const int flip = scene_uniform(&r) < 0.5;
            const int32_t p = corner(bad, c[0]), q = corner(bad, c[flip ? 2 : 1]), t = corner(bad, c[flip ? 1 : 2]);
            facet(bad, p, q, t);
        }
        const int32_t p = corner(bad, c[0]), q = corner(bad, c[1]),
                      t = corner(bad, dem__scale(0.5, dem__add(c[0], c[1])));
        facet(bad, p, q, t); /* no area: left out */
    }
    for (int k = 0; k < 2; k++) {
        start(&w[k], &def);
        if (k == 0) dem_add_plane(&w[k], 0, zero, up);
        else wall_index(dem_add_mesh(&w[k], 0, soup_mesh(bad)));
        add(&w[k], v3(-0.05, 0.001, radius), diameter);
        move(&w[k], 0, v3(0.7, 0.05, 0), v3(10, 20, 30));
        run(&w[k], 0.1, DEM_HERTZ | DEM_FRICTION | DEM_ROLLING);
    }
    near_vec(dem_position(&w[1], 0), dem_position(&w[0], 0), 1e-12, "position on a bad mesh");
    near_vec(dem_velocity(&w[1], 0), dem_velocity(&w[0], 0), 1e-10, "velocity on a bad mesh");
    for (int k = 0; k < 2; k++) dem_free(&w[k]);
    free(s), free(bad);
}

/* A drum of 24 sides and a ball in it: one contact at any time, which is never lost, and the energy of the
   true cylinder's. */
static void test_round_drum(void **state) {
    (void)state;
    const double rho[2] = {0.05, 0.05}, height[2] = {-0.05, 0.05};
    soup *s = new_soup();
    dem_world w;
    dem_def def = one_material(0.5, 0.5);
    def.gravity = v3(0, -9.81, 0);
    lathe(s, 2, rho, height, 24);
    start(&w, &def);
    wall_index(dem_add_mesh(&w, 0, soup_mesh(s)));
    /* at the height of the axis, begins in contact */
    add(&w, v3(-0.05 * cos(RIDDLE_PI / 24) + radius - 1e-6, 0, 0.001), diameter);
    double lowest = 0.0;
    for (int n = 0; n < 4000; n++) {
        run(&w, def.dt * 25, DEM_LINEAR | DEM_FRICTION);
        assert_true(dem_contact_count(&w) <= 1);
        const double v = dem__length(dem_velocity(&w, 0));
        lowest = dem_position(&w, 0).y < -0.046 ? (v > lowest ? v : lowest) : lowest;
    }
    /* rolls or slides down: between 5/7 and all of the energy less friction */
    assert_true(lowest > 0.4 && lowest < sqrt(2.0 * 9.81 * 0.0475));
    dem_free(&w), free(s);
}

/* The lower half of a sphere of 0.1 m in `rings` rings. */
static dem_mesh *bowl(soup *s, int rings) {
    double rho[200], height[200];
    for (int k = 0; k <= rings; k++)
        rho[k] = 0.1 * sin(0.5 * RIDDLE_PI * k / rings), height[k] = -0.1 * cos(0.5 * RIDDLE_PI * k / rings);
    lathe(s, rings + 1, rho, height, 2 * rings);
    return soup_mesh(s);
}

/* Boxes of the tree that a search within reach of p opens or leaves aside. */
static int boxes_seen(const dem__tree *t, dem_vec p, double reach) {
    int seen = 0;
    for (int32_t b = 0; b < t->nodes; seen++) b = dem__is_far(&t->node[b], p, reach) ? t->node[b].skip : b + 1;
    return seen;
}

/* A ball slides through a bowl of triangles as through the sphere, the nearer the finer; a search sees few boxes, and
   of a hundred times as many triangles not four times as many. */
static void test_fine_bowl(void **state) {
    (void)state;
    static const int rings[3] = {16, 64, 160}; /* 992, 16 256 and 102 080 triangles */
    double off[3] = {0.0}, seen[3] = {0.0};
    scene_random r = {17};
    for (int n = 0; n < 3; n++) {
        soup *s = new_soup();
        dem_world w[2];
        dem_def def = one_material(0.5, 0.0);
        int wall = 0;
        for (int k = 0; k < 2; k++) {
            start(&w[k], &def);
            wall =
                wall_index(k ? dem_add_mesh(&w[k], 0, bowl(s, rings[n])) : dem_add_sphere_wall(&w[k], 0, zero, 0.1, 1));
            add(&w[k], dem__scale(0.1 - radius, v3(0.6, 0.0, -0.8)), diameter);
            move(&w[k], 0, v3(0.0, 0.3, 0.0), zero);
        }
        for (int q = 0; q < 40; q++) {
            for (int k = 0; k < 2; k++) run(&w[k], 0.005, DEM_LINEAR | DEM_FRICTION);
            const double apart = dem__length(dem__sub(dem_position(&w[0], 0), dem_position(&w[1], 0)));
            off[n] = apart > off[n] ? apart : off[n];
        }
        const dem_wall *mesh = &w[1].wall[wall];
        /* at the pole half of them have no area */
        assert_int_equal(mesh->tree->triangles, 2 * rings[n] * (2 * rings[n] - 1));
        for (int q = 0; q < 1000; q++) {
            dem_vec p = scene_vector(&r, 1.0);
            p.z = -fabs(p.z) - 0.1;
            p = dem__sub(dem__scale((0.1 - radius) / dem__length(p), p), mesh->position);
            seen[n] += boxes_seen(mesh->tree, p, radius + 1e-5) / 1000.0;
        }
        for (int k = 0; k < 2; k++) dem_free(&w[k]);
        free(s);
    }
    if (!(off[1] < 1e-3 && off[2] < 2e-4)) fail_msg("off the sphere by %.2g and %.2g m after 0.2 s", off[1], off[2]);
    if (!(seen[2] < 200.0 && seen[2] < 4.0 * seen[0]))
        fail_msg("%.0f boxes are seen, %.0f of a coarse mesh", seen[2], seen[0]);
}

/* Over the edge of a block: the contact goes round the edge and lets go; without friction nothing is lost. */
static void test_convex_edge(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(1.0, 0.0);
    def.dt = 1e-6;
    start(&w, &def);
    wall_index(dem_add_box(&w, 0, v3(-0.05, -0.05, -0.1), v3(0, 0.05, 0)));
    dem_pair(&w.def, 0, 0)->stiffness = 1e5;
    const double rest = sqrt(1.0) * RIDDLE_PI / 6.0 * diameter * diameter * diameter * 2534.1 * 9.81 / 1e5;
    add(&w, v3(-0.004, 0.0013, radius - rest), diameter);
    move(&w, 0, v3(0.02, 0, 0), zero);
    const double before = 0.5 * 0.02 * 0.02 + 9.81 * (radius - rest);
    int edges = 0, most = 0;
    for (int n = 0; n < 300; n++) {
        run(&w, 1e-3, DEM_LINEAR);
        const dem_vec x = dem_position(&w, 0), v = dem_velocity(&w, 0);
        const int contacts = (int)dem_contact_count(&w);
        most = contacts > most ? contacts : most;
        if (contacts && x.x > 1e-5) edges++;
        if (x.z > -0.05) near_relative(0.5 * dem__dot(v, v) + 9.81 * x.z, before, 1e-4, "energy over an edge");
    }
    assert_int_equal(most, 1);
    assert_true(edges > 10);
    dem_free(&w);
}

/* One place is asked for, though a sphere in a corner has three: what lies behind is left alone. */
static void test_one_place_of_many(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.5, 0.3);
    dem__touch touch[1 + DEM__TOUCHES], marked;
    memset(&marked, 7, sizeof marked), memset(touch, 7, sizeof touch);
    start(&w, &def);
    const int box = wall_index(dem_add_box(&w, 0, zero, v3(0.1, 0.1, 0.1)));
    dem__touch_element(&w.wall[box], v3(0.9 * radius, 0.8 * radius, 0.7 * radius), radius, 0, touch);
    near_absolute(touch[0].gap, -0.3 * radius, 1e-15, "the nearest face");
    for (int k = 1; k <= DEM__TOUCHES; k++) assert_memory_equal(&touch[k], &marked, sizeof marked);
    dem_free(&w);
}

/* In the corner of a box under a tilted gravity: three contacts, each with its component of the weight. */
static void test_concave_corner(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.3, 0.0);
    def.gravity = v3(-2, -3, -9);
    start(&w, &def);
    const int box = wall_index(dem_add_box(&w, 0, zero, v3(0.05, 0.06, 0.07)));
    add(&w, v3(0.005, 0.0051, 0.0052), diameter);
    run(&w, 0.4, DEM_LINEAR);
    const double m = dem_mass(&w, 0);
    assert_int_equal(dem_contact_count(&w), 3);
    near_vec(w.wall[box].force, dem__scale(m, def.gravity), 1e-9 * m, "force on a box");
    double found[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        dem_contact_info c = dem_get_contact(&w, k);
        found[0] += c.force.x > 1e-9 * m, found[1] += c.force.y > 1e-9 * m, found[2] += c.force.z > 1e-9 * m;
    }
    assert_true(found[0] == 1 && found[1] == 1 && found[2] == 1);
    /* friction holds it in the corner of a frictional box as well */
    dem_free(&w);
    def = one_material(0.3, 0.4);
    def.gravity = v3(-2, -3, -9);
    start(&w, &def);
    wall_index(dem_add_box(&w, 0, zero, v3(0.05, 0.06, 0.07)));
    add(&w, v3(0.005, 0.0051, 0.0052), diameter);
    run(&w, 0.5, DEM_LINEAR | DEM_FRICTION);
    assert_true(dem__length(dem_velocity(&w, 0)) < 1e-4);
    dem_free(&w);
}

/* Settles in a cone, a tip of half angle 40 degrees: r/sin(40) over it. */
static void test_ball_in_a_cone(void **state) {
    (void)state;
    const double half = 40.0 * RIDDLE_PI / 180.0, depth = 0.05;
    for (int meshed = 0; meshed < 2; meshed++) {
        dem_world w;
        dem_def def = one_material(0.4, 0.3);
        soup *s = new_soup();
        const double rho[2] = {1e-9, depth * tan(half)}, height[2] = {0.0, depth};
        dem_cone cone = dem_default_cone();
        cone.low_radius = 0.0, cone.high_radius = depth * tan(half), cone.high = v3(0, 0, depth);
        lathe(s, 2, rho, height, 64);
        dem_pair(&def, 0, 0)->rolling = 5e-4;
        def.dt = 8e-6;
        start(&w, &def);
        if (meshed) wall_index(dem_add_mesh(&w, 0, soup_mesh(s)));
        else wall_index(dem_add_cone(&w, 0, &cone));
        add(&w, v3(0.012, 0.003, 0.03), diameter);
        move(&w, 0, v3(0.0, 0.1, 0.0), zero);
        run(&w, 2.0, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING);
        const dem_vec x = dem_position(&w, 0);
        /* of the polygon's inscribed circle */
        const double inner = meshed ? atan(tan(half) * cos(RIDDLE_PI / 64)) : half;
        near_absolute(x.z, radius / sin(inner), 3e-7, "height in a cone");
        near_absolute(hypot(x.x, x.y), 0.0, 1e-6, "on its axis");
        assert_true(dem__length(dem_velocity(&w, 0)) < 1e-3);
        dem_free(&w), free(s);
    }
}

/* Bouncing in a bowl without friction and without loss: the energy stays, in a spherical wall and in a meshed one. */
static void test_bouncing_in_a_bowl(void **state) {
    (void)state;
    const double bowl = 0.05;
    for (int meshed = 0; meshed < 2; meshed++) {
        double rho[25], height[25];
        soup *s = new_soup();
        dem_world w;
        dem_def def = one_material(1.0, 0.0);
        def.dt = 1e-6;
        start(&w, &def);
        for (int k = 0; k < 25; k++) { /* to 96 degrees from the lowest point */
            const double angle = k == 0 ? 1e-7 : RIDDLE_PI * k / 45.0;
            rho[k] = bowl * sin(angle), height[k] = -bowl * cos(angle);
        }
        lathe(s, 25, rho, height, 90);
        if (meshed) wall_index(dem_add_mesh(&w, 0, soup_mesh(s)));
        else wall_index(dem_add_sphere_wall(&w, 0, zero, bowl, 1));
        add(&w, v3(0.013, 0.002, -0.01), diameter);
        const double before = 9.81 * -0.01;
        int hits = 0;
        double pushed = 0.0;
        for (int n = 0; n < 1500; n++) {
            run(&w, 4e-4, DEM_LINEAR);
            const dem_vec v = dem_velocity(&w, 0);
            hits += w.wall[0].impulse.z != pushed, pushed = w.wall[0].impulse.z;
            if (!dem_contact_count(&w))
                near_relative(0.5 * dem__dot(v, v) + 9.81 * dem_position(&w, 0).z, before, 2e-4, "energy in a bowl");
        }
        assert_true(hits >= 4);
        dem_free(&w), free(s);
    }
}

/* ---- walls that move ---- */

static void shake(void *user, double time, dem_pose *pose) {
    const double *amplitude = (const double *)user;
    pose->shift.z = *amplitude * riddle_sin(2.0 * RIDDLE_PI * 50.0 * time);
    pose->shift.x = 0.3 * *amplitude * riddle_sin(2.0 * RIDDLE_PI * 50.0 * time);
}
static void turn_it(void *user, double time, dem_pose *pose) {
    (void)user;
    pose->turn = dem__scale(12.0 * time / sqrt(14.0), v3(1, 2, 3));
}
static void lose_it(void *user, double time, dem_pose *pose) {
    (void)user;
    pose->shift.x = time > 0.01 ? (double)NAN : 0.0;
}

static void nowhere(void *user, double time, dem_pose *pose) {
    (void)user, (void)time;
    pose->turn.y = (double)NAN;
}

static void hold_it(void *user, double time, dem_pose *pose) {
    (void)time;
    pose->shift.z = *(const double *)user;
}
static void test_prescribed_motion(void **state) {
    (void)state;
    double amplitude = 1e-3;
    dem_world w[2];
    for (int k = 0; k < 2; k++) {
        dem_def def = one_material(0.7, 0.3);
        start(&w[k], &def);
        dem_add_plane(&w[k], 0, zero, up);
        if (k == 0) dem_vibrate(&w[k], 0, v3(0.3 * amplitude, 0, amplitude), zero, 50.0);
        else assert_int_equal(dem_prescribe(&w[k], 0, v3(0.5, 0, 0), shake, &amplitude), DEM_OK);
        add(&w[k], v3(0, 0, radius + 1e-3), diameter);
    }
    for (int n = 0; n < 20; n++) {
        for (int k = 0; k < 2; k++) run(&w[k], 0.002, DEM_LINEAR | DEM_FRICTION);
        near_vec(w[1].wall[0].position, w[0].wall[0].position, 1e-14, "place of a function's wall");
        near_vec(w[1].wall[0].velocity, w[0].wall[0].velocity, 3e-7, "its velocity"); /* (2 pi f dt)^2/6 of 0.3 m/s */
        near_vec(w[1].wall[0].acceleration, w[0].wall[0].acceleration, 1e-4, "its acceleration");
        near_vec(dem_position(&w[1], 0), dem_position(&w[0], 0), 1e-8, "a ball on it");
    }
    for (int k = 0; k < 2; k++) dem_free(&w[k]);

    for (int k = 0; k < 2; k++) { /* a turning wall: frame, velocity and acceleration of its surface */
        dem_def def = one_material(0.7, 0.3);
        start(&w[k], &def);
        dem_add_cylinder(&w[k], 0, v3(0.02, 0, 0), v3(0, 1, 0), 0.05, 1);
        if (k == 0) dem_rotate(&w[k], 0, v3(0.01, 0.02, 0), v3(1, 2, 3), 12.0);
        else assert_int_equal(dem_prescribe(&w[k], 0, v3(0.01, 0.02, 0), turn_it, NULL), DEM_OK);
        add(&w[k], v3(0.02, 0, -0.04), diameter);
    }
    for (int n = 0; n < 20; n++) {
        for (int k = 0; k < 2; k++) run(&w[k], 0.002, DEM_LINEAR | DEM_FRICTION);
        const dem_vec at = v3(0.03, -0.02, 0.04);
        for (int a = 0; a < 3; a++) near_vec(w[1].wall[0].axis[a], w[0].wall[0].axis[a], 1e-13, "axis");
        near_vec(dem__surface_velocity(&w[1].wall[0], at, up), dem__surface_velocity(&w[0].wall[0], at, up), 1e-8,
                 "surface velocity");
        near_vec(dem__surface_acceleration(&w[1].wall[0], at), dem__surface_acceleration(&w[0].wall[0], at), 1e-4,
                 "surface acceleration");
        near_vec(dem_position(&w[1], 0), dem_position(&w[0], 0), 1e-7, "a ball in it");
    }
    for (int k = 0; k < 2; k++) dem_free(&w[k]);

    dem_def def = one_material(0.7, 0.3);
    start(&w[0], &def);
    dem_add_plane(&w[0], 0, zero, up);
    assert_int_equal(dem_prescribe(&w[0], 0, zero, lose_it, NULL), DEM_OK);
    add(&w[0], v3(0, 0, 0.1), diameter);
    assert_int_equal(dem_run(&w[0], 0.1, DEM_LINEAR), DEM_NOT_FINITE);
    near_absolute(w[0].time, 0.01, 2.0 * def.dt, "ended where the motion did");
    near_vec(w[0].wall[0].position, zero, 0.0, "and stayed there");
    assert_int_equal(dem_prescribe(&w[0], 0, zero, nowhere, NULL), DEM_BAD_ARGUMENT);
    dem_free(&w[0]);

    /* Another function puts it elsewhere: whoever waited for it far away looks anew. */
    static double low = 0.0, high = 0.09;
    def.gravity = zero;
    start(&w[0], &def);
    dem_add_plane(&w[0], 0, zero, up);
    assert_int_equal(dem_prescribe(&w[0], 0, zero, hold_it, &low), DEM_OK);
    add(&w[0], v3(0, 0, 0.1), diameter);
    move(&w[0], 0, v3(0, 0, -0.1), zero);
    run(&w[0], 0.01, DEM_LINEAR);
    assert_int_equal(dem_prescribe(&w[0], 0, zero, hold_it, &high), DEM_OK);
    run(&w[0], 0.1, DEM_LINEAR);
    near_relative(dem_velocity(&w[0], 0).z, 0.07, 1e-3, "after a wall that was put elsewhere");
    dem_free(&w[0]);
}

/* A piston presses a column of five against a fixed plane; and without a column it is a body under a force
   and a damper. */
static void test_piston(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.3, 0.3);
    const double target = 0.25, mass = 0.02;
    start(&w, &def);
    const int lid = wall_index(dem_add_plane(&w, 0, v3(0, 0, 5.2 * diameter), v3(0, 0, -1)));
    const int piston = wall_index(dem_add_plane(&w, 0, zero, up));
    for (int k = 0; k < 5; k++) add(&w, v3(0, 0, radius + k * diameter), diameter);
    assert_int_equal(dem_control_force(&w, piston, v3(0, 0, 2), mass, target, 2.0), DEM_OK);
    run(&w, 1.5, DEM_LINEAR | DEM_FRICTION);
    const double weight = 5.0 * dem_mass(&w, 0) * 9.81;
    near_relative(w.wall[piston].force.z, -target, 1e-6, "force on the piston");
    near_relative(w.wall[lid].force.z, target - weight, 1e-6, "force on the lid");
    near_absolute(w.wall[piston].rate, 0.0, 1e-9, "piston at rest");
    near_absolute(w.wall[piston].position.z, w.wall[piston].coordinate, 1e-15, "position");
    assert_true(w.wall[piston].coordinate > 0.2 * diameter); /* the gap above is closed, the column compressed */
    assert_int_equal(dem_control_force(&w, piston, up, mass, 0.4 * target, 2.0), DEM_OK); /* another target */
    run(&w, 1.5, DEM_LINEAR | DEM_FRICTION);
    near_relative(w.wall[piston].force.z, -0.4 * target, 1e-6, "the new force");
    dem_free(&w);

    start(&w, &def);
    const int free_one = wall_index(dem_add_plane(&w, 0, zero, up));
    assert_int_equal(dem_move(&w, free_one, v3(0, 0, 0.5)), DEM_OK);
    assert_int_equal(dem_control_force(&w, free_one, up, 2.0, 3.0, 4.0), DEM_OK);
    run(&w, 0.7, DEM_LINEAR);
    const double decay = exp(-0.7 * 4.0 / 2.0), last = 3.0 / 4.0;
    near_relative(w.wall[free_one].rate, last + (0.5 - last) * decay, 1e-10, "speed under force and damper");
    near_relative(w.wall[free_one].coordinate, last * 0.7 + (0.5 - last) * 2.0 / 4.0 * (1.0 - decay), 1e-9, "its way");
    dem_free(&w);
}

/* A ball hits a free piston: momentum goes over, e of the pair as the heavy wall has it. */
static void test_piston_momentum(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(1.0, 0.4);
    def.gravity = zero;
    start(&w, &def);
    const int wall = wall_index(dem_add_plane(&w, 0, zero, up));
    add(&w, v3(0, 0, 2.0 * radius), diameter);
    const double m = dem_mass(&w, 0), mass = 30.0 * m;
    assert_int_equal(dem_control_force(&w, wall, up, mass, 0.0, 0.0), DEM_OK);
    move(&w, 0, v3(0.1, 0, -1.0), zero);
    run(&w, 0.02, DEM_LINEAR);
    assert_int_equal(dem_contact_count(&w), 0);
    near_absolute(m * dem_velocity(&w, 0).z + mass * w.wall[wall].rate, -m, 1e-14 * m, "momentum of ball and piston");
    near_relative(dem_velocity(&w, 0).z - w.wall[wall].rate, 1.0, 1e-3, "elastic");
    near_vec(w.wall[wall].impulse, v3(0, 0, mass * w.wall[wall].rate), 1e-12 * m, "impulse");
    dem_free(&w);
}

/* No gravity; a ball runs round in a free drum and drags it along, until it rolls. Angular momentum stays, and
   says how fast. */
static void test_rotor(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.5, 0.3);
    const double drum = 0.05, inertia = 2e-6, v0 = 1.0;
    def.gravity = zero;
    def.dt = 2e-6;
    start(&w, &def);
    const int k = wall_index(dem_add_cylinder(&w, 0, zero, v3(0, 1, 0), drum, 1));
    add(&w, v3(drum - radius, 0.01, 0), diameter);
    const double m = dem_mass(&w, 0), i = 0.4 * m * radius * radius;
    assert_int_equal(dem_control_torque(&w, k, v3(0, 3, 0), v3(0, 1, 0), inertia, 0.0, 0.0), DEM_OK);
    move(&w, 0, v3(0, 0, -v0), zero); /* about +y */
    const double before = m * v0 * (drum - radius);
    for (int n = 0; n < 50; n++) {
        run(&w, 0.02, DEM_LINEAR | DEM_FRICTION);
        dem__set_origin(&w, 0);
        const dem_vec moment = dem__cross(dem_position(&w, 0), dem_velocity(&w, 0));
        near_relative(m * moment.y + i * dem_spin(&w, 0).y + inertia * w.wall[k].rate, before, 1e-10,
                      "angular momentum");
    }
    /* the same impulse j brakes the ball, and turns ball and drum: v - j/m + j r^2/i ... until the
       surfaces run alike */
    const double j = v0 / (1.0 / m + radius * radius / i + drum * drum / inertia);
    near_relative(w.wall[k].rate, j * drum / inertia, 2e-3, "rate of the drum"); /* the overlap is 1e-4 of the radius */
    near_relative(w.wall[k].spin, w.wall[k].rate, 0.0, "spin");
    near_relative(dem_wall_angular_impulse(&w, k, v3(0, 3, 0)).y, inertia * w.wall[k].rate, 1e-5, "angular impulse");
    dem_free(&w);

    start(&w, &def); /* torque and damper */
    assert_int_equal(wall_index(dem_add_box(&w, 0, v3(0, 0, 0), v3(1, 0.1, 0.1))), 0);
    assert_int_equal(dem_control_torque(&w, 0, v3(0.2, 0, 0), v3(0, 0, 3), 0.5, 2.0, 0.7), DEM_OK);
    run(&w, 0.4, DEM_LINEAR);
    const double decay = exp(-0.4 * 0.7 / 0.5), angle = 2.0 / 0.7 * (0.4 - 0.5 / 0.7 * (1.0 - decay));
    near_relative(w.wall[0].rate, 2.0 / 0.7 * (1.0 - decay), 1e-9, "rate");
    near_relative(w.wall[0].coordinate, angle, 1e-9, "angle");
    near_vec(w.wall[0].axis[0], v3(cos(angle), sin(angle), 0), 1e-9, "axis");
    near_vec(w.wall[0].position,
             v3(0.2 + 0.3 * cos(angle) - 0.05 * sin(angle), 0.3 * sin(angle) + 0.05 * cos(angle), 0.05), 1e-9, "place");
    dem_free(&w);
}

/* On a belt of speed u a ball slips until 2 u/(7 mu g), then rolls with 2/7 u and its surface at u; on a plane and
   on triangles. */
static void test_belt(void **state) {
    (void)state;
    const double u = 0.35, mu = 0.25, slips = 2.0 * u / (7.0 * mu * 9.81);
    for (int meshed = 0; meshed < 2; meshed++) {
        dem_world w;
        dem_def def = one_material(0.5, mu);
        start(&w, &def);
        const double rest = RIDDLE_PI / 6.0 * diameter * diameter * diameter * 2534.1 * 9.81 / 1e5;
        if (meshed) wall_index(dem_add_box(&w, 0, v3(-1, -1, -0.1), v3(1, 1, 0)));
        else wall_index(dem_add_plane(&w, 0, zero, up));
        assert_int_equal(dem_set_belt(&w, 0, v3(u, 0, 5.0)), DEM_OK); /* the part along the surface counts */
        add(&w, v3(0, 0, radius - rest), diameter);
        run(&w, 0.5 * slips, DEM_LINEAR | DEM_FRICTION);
        near_relative(dem_velocity(&w, 0).x, mu * 9.81 * 0.5 * slips, 2e-3, "slipping on a belt");
        run(&w, 0.48 * slips, DEM_LINEAR | DEM_FRICTION);
        near_relative(dem_velocity(&w, 0).x, mu * 9.81 * 0.98 * slips, 2e-3, "still slipping");
        run(&w, 0.1, DEM_LINEAR | DEM_FRICTION);
        near_relative(dem_velocity(&w, 0).x, 2.0 / 7.0 * u, 2e-3, "rolling on a belt");
        near_relative(w.wall[0].work, 2.0 / 7.0 * u * u * dem_mass(&w, 0), 2e-2,
                      "work of a belt"); /* u times the momentum */
        dem__set_origin(&w, 0);
        near_relative(w.particle[0].v.x - radius * dem_spin(&w, 0).y, u, 2e-3, "its surface");
        near_vec(w.wall[0].velocity, zero, 0.0, "the belt's frame stays");
        dem_free(&w);
    }
}

/* A belt that runs around an axis: on a round wall it moves a ball as the wall's own rotation does, at the same power;
   on the top of a box as a plane belt does, on its underside the other way; on its front, across the
   axis, not at all. */
static void test_belt_around_an_axis(void **state) {
    (void)state;
    const double u = 0.35, drum = 0.05;
    dem_vec x[2], v[2];
    double work[2];
    for (int turns = 0; turns < 2; turns++) {
        dem_world w;
        dem_def def = one_material(0.5, 0.25);
        start(&w, &def);
        const int k = wall_index(dem_add_cylinder(&w, 0, zero, v3(0, 1, 0), drum, 1));
        assert_int_equal(turns ? dem_rotate(&w, k, zero, v3(0, 1, 0), u / drum) : dem_turn_belt(&w, k, v3(0, -3, 0), u),
                         DEM_OK);
        add(&w, v3(0, 0, radius - drum), diameter);
        run(&w, 0.3, DEM_LINEAR | DEM_FRICTION);
        x[turns] = dem_position(&w, 0), v[turns] = dem_velocity(&w, 0), work[turns] = w.wall[k].work;
        dem_free(&w);
    }
    near_vec(x[0], x[1], 1e-6, "place"), near_vec(v[0], v[1], 1e-4, "velocity");
    near_relative(work[0], work[1], 1e-3, "work");
    assert_true(work[0] > 0.0 && fabs(x[0].x) > 1e-3);
    static const double pull[3][3] = {{0, 0, -9.81}, {0, 0, 9.81}, {0, 9.81, 0}}, speed[3] = {0.1, -0.1, 0.0};
    for (int side = 0; side < 3; side++) {
        dem_world w;
        dem_def def = one_material(0.5, 0.25);
        def.gravity = v3(pull[side][0], pull[side][1], pull[side][2]);
        start(&w, &def);
        const int k = wall_index(dem_add_box(&w, 0, v3(-1, -0.1, -0.1), v3(1, 0.1, 0.1)));
        assert_int_equal(dem_turn_belt(&w, k, v3(0, 1, 0), u), DEM_OK);
        add(&w,
            side == 0   ? v3(0, 0, 0.1 + radius)
            : side == 1 ? v3(0, 0, -0.1 - radius)
                        : v3(0, -0.1 - radius, 0),
            diameter);
        run(&w, 0.5, DEM_LINEAR | DEM_FRICTION);
        near_absolute(dem_velocity(&w, 0).x, speed[side], 1e-3, "speed on a side"); /* 2/7 of the belt's */
        dem_free(&w);
    }
    dem_world w;
    dem_def def = one_material(0.5, 0.25);
    start(&w, &def);
    wall_index(dem_add_plane(&w, 0, zero, up));
    assert_int_equal(dem_turn_belt(&w, 0, zero, 1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_turn_belt(&w, 1, up, 1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_turn_belt(&w, 0, up, nan_), DEM_BAD_ARGUMENT);
    dem_free(&w);
}

/* ---- everything at once: skipping, threads, saving, memory ---- */

/* A box of triangles with a falling lid, a free paddle, a shaken cone, a belt and spheres of three sizes. */
static dem_status busy_scene(dem_world *w, int skip, int threads, const dem_allocator *allocator) {
    static double amplitude = 1e-3;
    const double sizes[3] = {5e-3, 4e-3, 3e-3};
    scene_random r = {78};
    dem_def def = scene_def(5e-6);
    soup *s;
    dem_cone cone = dem_default_cone();
    dem_disc ring = dem_default_disc();
    int box, lid, paddle, funnel, ball, bottom;
    dem_status status;
    def.skip = skip, def.threads = threads;
    def.gravity = v3(0, 0, -30);
    if (allocator) def.allocator = *allocator;
    status = dem_init(w, &def, NULL);
    if (status != DEM_OK) return status;
    s = (soup *)calloc(1, sizeof *s);
    if (!s) return DEM_OUT_OF_MEMORY;
    box = dem_add_box(w, 1, v3(-0.02, -0.02, -0.01), v3(0.02, 0.02, 0.06));
    lid = dem_add_plane(w, 1, v3(0, 0, 0.055), v3(0, 0, -1));
    patch(s, v3(-0.015, 0, 0.003), v3(0.03, 0, 0), v3(0, 0, 0.008), 7, 3, 0.3, &r);
    paddle = dem_add_mesh(w, 1, soup_mesh(s));
    free(s);
    cone.low = v3(0, 0, 0.015), cone.high = v3(0, 0, 0.03), cone.low_radius = 0.008, cone.high_radius = 0.018;
    funnel = dem_add_cone(w, 1, &cone);
    ball = dem_add_sphere_wall(w, 1, v3(0.012, 0.01, -0.006), 0.005, 0);
    ring.centre = v3(0.002, -0.003, 0.002), ring.normal = v3(0.3, 0.1, 1), ring.radius = 0.013,
    ring.hole_radius = 0.006;
    bottom = dem_add_disc(w, 1, &ring);
    if (box < 0 || lid < 0 || paddle < 0 || funnel < 0 || ball < 0 || bottom < 0) return DEM_OUT_OF_MEMORY;
    dem_rotate(w, bottom, ring.centre, v3(0.2, 0, 1), 8.0);
    dem_set_belt(w, box, v3(0.1, 0, 0));
    dem_control_force(w, lid, up, 0.01, -0.2, 0.05);
    dem_control_torque(w, paddle, zero, up, 1e-6, 2e-4, 1e-6);
    dem_prescribe(w, funnel, zero, shake, &amplitude);
    status = scene_fill(w, &r, 6, 6, 4, v3(-0.0195, -0.0195, 0.031), 0.006, sizes, 3, 0.2);
    return status == DEM_OK ? scene_fill(w, &r, 5, 5, 1, v3(-0.015, -0.015, -0.0095), 0.006, sizes, 3, 0.2) : status;
}

enum { BUSY = DEM_LINEAR | DEM_FRICTION | DEM_ROLLING };

/* Work that all walls have done. */
static double work_of_walls(const dem_world *w) {
    double sum = 0.0;
    for (int k = 0; k < w->walls; k++) sum += w->wall[k].work;
    return sum;
}

/* The work of each wall against the ledger, which has the sum of all: pushed, turned, shaken and running ones, of
   triangles, cones, planes, discs; the same bits for any number of threads, without skipping, and after a save. */
static void test_work_of_walls(void **state) {
    (void)state;
    double work[3][DEM_WALLS_MAX], last = 0.0;
    for (int how = 0; how < 3; how++) {
        dem_world w;
        assert_int_equal(busy_scene(&w, how != 1, how == 2 ? 3 : 1, NULL), DEM_OK);
        run(&w, 0.02, BUSY | DEM_ENERGY);
        if (how == 2) { /* saved in the midst of it */
            const size_t size = dem_save(&w, NULL, 0);
            unsigned char *bytes = (unsigned char *)malloc(size);
            dem_motion_fn motion = w.wall[3].asked.motion;
            void *user = w.wall[3].asked.motion_user;
            assert_int_equal(dem_save(&w, bytes, size), size);
            dem_free(&w);
            assert_int_equal(dem_load(&w, bytes, size, NULL), DEM_OK);
            assert_int_equal(dem_prescribe(&w, 3, zero, motion, user), DEM_OK);
            free(bytes);
        }
        run(&w, 0.02, BUSY | DEM_ENERGY);
        const dem_energy_ledger l = dem_energy(&w);
        near_absolute(work_of_walls(&w), l.wall_work, 1e-3 * fabs(l.wall_work), "work of the walls");
        last = l.wall_work;
        for (int k = 0; k < w.walls; k++) work[how][k] = w.wall[k].work;
        dem_free(&w);
    }
    assert_true(fabs(last) > 1e-6);
    for (int k = 0; k < 6; k++) {
        assert_true(k == 4 ? work[0][k] == 0.0 : work[0][k] != 0.0); /* the ball stays */
        assert_true(work[0][k] == work[1][k] && work[0][k] == work[2][k]);
    }
}

/* Angular momentum of a ball about an axis along y [N m s]. */
static double moment_about(dem_world *w, dem_vec centre) {
    dem__set_origin(w, 0);
    const dem_vec orbit = dem__cross(dem__sub(dem_position(w, 0), centre), dem_velocity(w, 0));
    return dem_mass(w, 0) * (orbit.y + 0.4 * radius * radius * dem_spin(w, 0).y);
}

/* A ball rocks in a drum that turns, against rolling resistance: the torque on the drum is weight x arm but for the
   ball's angular momentum, the power torque x spin; far from the origin, turned either way. */
static void test_torque_of_a_drum(void **state) {
    (void)state;
    for (int way = -1; way <= 1; way += 2) {
        dem_world w;
        dem_def def = one_material(0.5, 0.4);
        const double drum = 0.05, spin = 8.0 * way, lever = 2e-4;
        const dem_vec centre = v3(3.0, -1.0, 7.0);
        dem_pair(&def, 0, 0)->rolling = lever;
        start(&w, &def);
        const int k = wall_index(dem_add_cylinder(&w, 0, centre, v3(0, 1, 0), drum, 1));
        assert_int_equal(dem_rotate(&w, k, centre, v3(0, 1, 0), spin), DEM_OK);
        add(&w, v3(centre.x, centre.y, centre.z - drum + radius), diameter);
        run(&w, 0.1, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING);
        const double before = dem_wall_angular_impulse(&w, k, centre).y, done = w.wall[k].work,
                     moment = moment_about(&w, centre);
        double arm = 0.0;
        for (int n = 0; n < 5000; n++) {
            const double was = dem_position(&w, 0).x;
            run(&w, 10.0 * def.dt, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING);
            arm += (0.5 * (was + dem_position(&w, 0).x) - centre.x) / 5000.0;
        }
        const double time = 50000.0 * def.dt, turned = dem_wall_angular_impulse(&w, k, centre).y - before;
        const double weight = dem_mass(&w, 0) * 9.81;
        near_relative(w.wall[k].work - done, -turned * spin, 1e-9, "work = torque x angle");
        near_relative(turned, weight * arm * time - (moment_about(&w, centre) - moment), 1e-4, "torque = weight x arm");
        assert_true(-turned * spin > 0.0);
        dem_free(&w);
    }
}

static void test_skipping_changes_nothing(void **state) {
    (void)state;
    uint64_t hash[4] = {0, 0, 0, 0};
    int64_t looks[2] = {0, 0};
    for (int setting = 0; setting < 7; setting++) {
        const int threads[3] = {1, 2, 5};
        dem_world w;
        assert_int_equal(
            busy_scene(&w, setting < 4 ? setting : DEM_SKIP_ALL, setting < 4 ? 1 : threads[setting - 4], NULL), DEM_OK);
        for (int n = 0; n < 4; n++) {
            run(&w, 0.025, BUSY);
            if (setting == 0) hash[n] = dem_hash(&w);
            assert_int_equal(dem_hash(&w), hash[n]);
        }
        if (setting == 0) {
            assert_true(w.contact_steps > 100000 && w.wall[1].coordinate < -1e-3 && fabs(w.wall[2].coordinate) > 0.1);
        }
        if (setting == 0 || setting == 3) looks[setting / 3] = w.looks;
        dem_free(&w);
    }
    assert_true(20 * looks[1] < looks[0]);
}

static void test_saving(void **state) {
    (void)state;
    static double amplitude = 1e-3;
    dem_world w, again;
    assert_int_equal(busy_scene(&w, DEM_SKIP_ALL, 1, NULL), DEM_OK);
    for (int n = 0; n < 3; n++) {
        run(&w, 0.01, BUSY);
        const size_t size = dem_save(&w, NULL, 0);
        unsigned char *bytes = (unsigned char *)malloc(2 * size);
        assert_non_null(bytes);
        assert_int_equal(dem_save(&w, bytes, size), size);
        assert_int_equal(dem_load(&again, bytes, size, NULL), DEM_OK);
        assert_int_equal(dem_save(&again, bytes + size, size), size);
        assert_memory_equal(bytes, bytes + size, size);
        assert_int_equal(dem_run(&again, 0.001, BUSY), DEM_NO_MOTION);
        assert_int_equal(dem_prescribe(&again, 3, zero, shake, &amplitude), DEM_OK);
        run(&w, 0.01, BUSY), run(&again, 0.01, BUSY);
        assert_int_equal(dem_hash(&again), dem_hash(&w));
        near_vec(again.wall[3].position, w.wall[3].position, 0.0, "a function's wall");
        dem_free(&again);
        scene_random r = {(uint64_t)n}; /* forged: refused, or it runs */
        for (int k = 0; k < 60; k++) {
            uint64_t check = 0xcbf29ce484222325u;
            memcpy(bytes + size, bytes, size);
            for (int flips = 0; flips < 3; flips++) {
                const size_t at = k < 30 ? size - 8 - (size_t)(6000.0 * scene_uniform(&r))
                                         : (size_t)(scene_uniform(&r) * (double)(size - 8));
                bytes[size + at] = (unsigned char)(256.0 * scene_uniform(&r));
            }
            for (size_t q = 0; q + 8 < size; q++) check = (check ^ bytes[size + q]) * 0x100000001b3u;
            for (int q = 0; q < 8; q++) bytes[2 * size - 8 + (size_t)q] = (unsigned char)(check >> (8 * q));
            if (dem_load(&again, bytes + size, size, NULL) != DEM_OK) continue;
            dem_prescribe(&again, 3, zero, shake, &amplitude);
            dem_run(&again, 2e-5, BUSY);
            dem_free(&again);
        }
        for (size_t cut = 0; cut < size; cut += 997) assert_int_equal(dem_load(&again, bytes, cut, NULL), DEM_BAD_DATA);
        free(bytes);
    }
    dem_free(&w);
}

/* A saved wall of a kind that nobody knows, or with lengths that its kind cannot have, is refused. */
static void test_unsound_walls(void **state) {
    (void)state;
    const int kinds[] = {-1, -(1 << 30), 1 << 20, INT32_MAX, 77};
    for (int bad = 0; bad < 14; bad++) {
        const dem_def def = one_material(0.5, 0.3);
        dem_cone cone = dem_default_cone();
        dem_screen screen = dem_default_screen();
        dem_world w, again;
        start(&w, &def);
        dem_wall *wall = &w.wall[0];
        wall_index(bad < 8 ? dem_add_cylinder(&w, 0, zero, up, 0.1, 1)
                           : bad < 11 ? dem_add_cone(&w, 0, &cone) : dem_add_screen(&w, 0, &screen));
        if (bad < 5) wall->kind = kinds[bad];
        if (bad == 5) wall->radius = 0.0;
        if (bad == 6) wall->radius = nan_;
        if (bad == 7) wall->solid = 1;
        if (bad == 8) wall->length = 0.0;
        if (bad == 9) wall->length = inf;
        if (bad == 10) wall->radius = -1.0;
        if (bad == 11) wall->profile = 2;
        if (bad == 12) wall->wire = nan_;
        const size_t size = dem_save(&w, NULL, 0);
        unsigned char *bytes = (unsigned char *)malloc(size);
        assert_non_null(bytes);
        assert_int_equal(dem_save(&w, bytes, size), size);
        assert_int_equal(dem_load(&again, bytes, size, NULL), bad < 13 ? DEM_BAD_DATA : DEM_OK);
        if (bad == 13) dem_free(&again);
        free(bytes);
        dem_free(&w);
    }
}

/* A ball that rolls over the rim of a funnel, from within to without: a save in the midst of that contact, or a sphere
   that is added far away, changes nothing of it. */
static void test_rim(void **state) {
    (void)state;
    uint64_t hash[2];
    double speed[3];
    for (int k = 0; k < 3; k++) {
        dem_world w, again;
        dem_def def = one_material(0.9, 0.3);
        dem_cone cone = dem_default_cone();
        def.material[0].young_modulus = 1e6;
        start(&w, &def);
        assert_int_equal(dem_add_cone(&w, 0, &cone), 0);
        add(&w, v3(0.1 - 0.6 * radius, 0, 0.1 + 0.799 * radius), diameter);
        move(&w, 0, v3(0.12, 0, 0.09), v3(0, 60.0, 0));
        run(&w, 0.002, DEM_HERTZ | DEM_FRICTION);
        assert_int_equal(dem_contact_count(&w), 1);
        assert_true(dem_position(&w, 0).x < 0.1);
        while (dem_position(&w, 0).x < 0.1) run(&w, 1e-5, DEM_HERTZ | DEM_FRICTION);
        assert_int_equal(dem_contact_count(&w), 1);
        if (k == 1) {
            const size_t size = dem_save(&w, NULL, 0);
            unsigned char *bytes = (unsigned char *)malloc(size);
            assert_non_null(bytes);
            assert_int_equal(dem_save(&w, bytes, size), size);
            assert_int_equal(dem_load(&again, bytes, size, NULL), DEM_OK);
            free(bytes);
            dem_free(&w);
            w = again;
        }
        if (k == 2) add(&w, v3(1, 1, 1), radius);
        run(&w, 0.002, DEM_HERTZ | DEM_FRICTION);
        if (k < 2) hash[k] = dem_hash(&w);
        speed[k] = dem_velocity(&w, 0).x;
        dem_free(&w);
    }
    assert_true(hash[0] == hash[1]);
    near_absolute(speed[2], speed[0], 1e-9, "speed after a sphere was added");

    for (int k = 0; k < 2; k++) { /* a ball wider than the ring on which it falls */
        dem_world w;
        dem_def def = one_material(0.3, 0.3);
        dem_cone cone = dem_default_cone();
        const double r = k ? 0.015 : 0.1;
        cone.low_radius = k ? 0.004 : 0.02, cone.high_radius = k ? 0.006 : 0.02, cone.high.z = k ? 0.005 : 0.05;
        start(&w, &def);
        assert_int_equal(dem_add_cone(&w, 0, &cone), 0);
        add(&w, v3(0, 1e-6, cone.high.z + sqrt(r * r - cone.high_radius * cone.high_radius)), 2.0 * r);
        run(&w, 0.02, DEM_HERTZ | DEM_FRICTION);
        assert_true(w.contact_steps > 0);
        dem_free(&w);
    }
}

static void test_out_of_memory(void **state) {
    (void)state;
    failing_allocator memory;
    dem_allocator hook = {failing_fn, NULL};
    hook.user = &memory;
    for (int k = 0;; k++) {
        dem_world w, again;
        failing_init_at(&memory, k);
        dem_status status = busy_scene(&w, DEM_SKIP_ALL, 1, &hook);
        if (status == DEM_OK) status = dem_run(&w, 0.02, BUSY);
        assert_true(status == DEM_OK || status == DEM_OUT_OF_MEMORY);
        if (status == DEM_OK) {
            const size_t size = dem_save(&w, NULL, 0);
            unsigned char *bytes = (unsigned char *)malloc(size);
            dem_save(&w, bytes, size);
            dem_free(&w);
            for (int q = 0; !memory.has_failed; q++) {
                failing_allocator other;
                hook.user = &other;
                failing_init_at(&other, q);
                status = dem_load(&again, bytes, size, &hook);
                assert_int_equal(status, other.has_failed ? DEM_OUT_OF_MEMORY : DEM_OK);
                if (status == DEM_OK) dem_free(&again);
                assert_int_equal(failing_live(&other), 0);
                hook.user = &memory;
                if (!other.has_failed) break;
            }
            free(bytes);
        } else dem_free(&w);
        assert_int_equal(failing_live(&memory), 0);
        if (!memory.has_failed) break;
    }
}

static void test_bad_arguments(void **state) {
    (void)state;
    dem_world w;
    dem_def def = one_material(0.8, 0.3);
    double vertex[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    int32_t triangle[3] = {0, 1, 2};
    dem_mesh mesh;
    const int bad = -(int)DEM_BAD_ARGUMENT;
    memset(&mesh, 0, sizeof mesh);
    mesh.vertices = 3, mesh.triangles = 1, mesh.vertex = vertex, mesh.triangle = triangle;
    start(&w, &def);
    assert_int_equal(dem_add_mesh(NULL, 0, &mesh), bad), assert_int_equal(dem_add_mesh(&w, 0, NULL), bad);
    assert_int_equal(dem_add_mesh(&w, 1, &mesh), bad), assert_int_equal(dem_add_mesh(&w, -1, &mesh), bad);
    for (int k = 0; k < 9; k++) {
        const double kept = vertex[k];
        const double wrong[3] = {nan_, inf, 1e60};
        for (int q = 0; q < 3; q++) vertex[k] = wrong[q], assert_int_equal(dem_add_mesh(&w, 0, &mesh), bad);
        vertex[k] = kept;
    }
    triangle[1] = 3, assert_int_equal(dem_add_mesh(&w, 0, &mesh), bad);
    triangle[1] = -1, assert_int_equal(dem_add_mesh(&w, 0, &mesh), bad);
    triangle[1] = 2, assert_int_equal(dem_add_mesh(&w, 0, &mesh), bad); /* no area */
    triangle[1] = 1, mesh.triangles = 0, assert_int_equal(dem_add_mesh(&w, 0, &mesh), bad);
    mesh.triangles = PTRDIFF_MAX, assert_int_equal(dem_add_mesh(&w, 0, &mesh), bad);
    mesh.triangles = 1, vertex[3] = 1e-300, vertex[7] = 1e-300, assert_int_equal(dem_add_mesh(&w, 0, &mesh), bad);
    vertex[3] = vertex[7] = 1.0;
    dem_cone cone = dem_default_cone();
    cone.low_radius = cone.high_radius = 0.0, assert_int_equal(dem_add_cone(&w, 0, &cone), bad);
    cone.low_radius = nan_, assert_int_equal(dem_add_cone(&w, 0, &cone), bad);
    cone = dem_default_cone(), cone.high = cone.low, assert_int_equal(dem_add_cone(&w, 0, &cone), bad);
    cone.high.x = inf, assert_int_equal(dem_add_cone(&w, 0, &cone), bad),
    assert_int_equal(dem_add_cone(&w, 0, NULL), bad);
    const double wrong[4] = {nan_, inf, -1.0, 1e200};
    for (int k = 0; k < 4; k++) {
        dem_disc disc = dem_default_disc();
        if (k < 3) disc.radius = wrong[k], assert_int_equal(dem_add_disc(&w, 0, &disc), bad);
        disc.radius = 1.0, disc.hole_radius = wrong[k], assert_int_equal(dem_add_disc(&w, 0, &disc), bad);
        disc.hole_radius = 0.0, disc.centre.y = wrong[k];
        if (k != 2) assert_int_equal(dem_add_disc(&w, 0, &disc), bad);
        disc.centre.y = 0.0, disc.normal = k < 2 ? v3(0, wrong[k], 0) : zero,
        assert_int_equal(dem_add_disc(&w, 0, &disc), bad);
    }
    dem_disc whole = dem_default_disc();
    whole.hole_radius = whole.radius, assert_int_equal(dem_add_disc(&w, 0, &whole), bad);
    whole = dem_default_disc(), assert_int_equal(dem_add_disc(&w, 1, &whole), bad),
    assert_int_equal(dem_add_disc(&w, -1, &whole), bad);
    assert_int_equal(dem_add_disc(NULL, 0, &whole), bad), assert_int_equal(dem_add_disc(&w, 0, NULL), bad);
    assert_int_equal(dem_add_sphere_wall(&w, 0, zero, 0.0, 1), bad),
        assert_int_equal(dem_add_sphere_wall(&w, 0, v3(nan_, 0, 0), 1.0, 1), bad);
    assert_int_equal(dem_add_box(&w, 0, zero, v3(1, 1, 0)), bad),
        assert_int_equal(dem_add_box(&w, 0, zero, v3(1, 1, nan_)), bad);
    assert_int_equal(w.walls, 0);
    assert_int_equal(dem_add_mesh(&w, 0, &mesh), 0);
    assert_int_equal(dem_set_belt(&w, 1, up), DEM_BAD_ARGUMENT),
        assert_int_equal(dem_set_belt(&w, 0, v3(0, inf, 0)), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_prescribe(&w, 0, zero, NULL, NULL), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_control_force(&w, 0, zero, 1.0, 1.0, 1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_control_force(&w, 0, up, 0.0, 1.0, 1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_control_force(&w, 0, up, 1.0, nan_, 1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_control_torque(&w, 0, zero, up, 1.0, 1.0, -1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_control_torque(&w, 0, v3(nan_, 0, 0), up, 1.0, 1.0, 1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(w.wall[0].asked.drive, DEM_KINEMATIC);
    for (int k = 1; k < DEM_WALLS_MAX; k++) assert_int_equal(dem_add_mesh(&w, 0, &mesh), k);
    assert_int_equal(dem_add_mesh(&w, 0, &mesh), -(int)DEM_TOO_MANY), assert_int_equal(dem_add_cone(&w, 0, &cone), bad);
    dem_free(&w);
}

/* ---- rolling where the normal turns ---- */

/* Rolls a ball that spins about its normal, too, and returns what the ledger misses over the energy at the start. */
static double missed_energy(dem_world *w, dem_vec x, dem_vec v, dem_vec spin, double ball, double time) {
    const int features = DEM_LINEAR | DEM_FRICTION | DEM_ENERGY;
    add(w, x, ball);
    assert_int_equal(dem_set_time_step(w, dem_advise(w, DEM_LINEAR, 1.0).advised), DEM_OK);
    assert_int_equal(dem_set_motion(w, w->count - 1, v, spin), DEM_OK);
    assert_int_equal(dem_run(w, 0.02 * time, features), DEM_OK);
    const dem_energy_ledger before = dem_energy(w);
    assert_int_equal(dem_run(w, time, features), DEM_OK);
    const dem_energy_ledger after = dem_energy(w);
    return (after.error - before.error) / (before.kinetic + before.rotational);
}

static dem_def rolling_material(void) {
    dem_def def = one_material(0.5, 1.0);
    dem_pair(&def, 0, 0)->stiffness = 1e6;
    return def;
}

static void test_rolling_keeps_its_energy(void **state) {
    (void)state;
    const double r = 0.01, round = 0.06, omega = 60.0, b = round - r, bob = 2.0 * RIDDLE_PI / (sqrt(2.0 / 7.0) * omega);
    dem_def def = rolling_material();
    const double mass = def.material[0].density * 4.0 / 3.0 * RIDDLE_PI * r * r * r,
                 out = b + mass * omega * omega * b / 1e6;
    dem_world w;
    double drift;
    start(&w, &def); /* bobbing up and down in a vertical cylinder, ten times */
    dem_add_cylinder(&w, 0, zero, v3(0, 0, 1), round, 1);
    drift = missed_energy(&w, v3(out, 0, 0), v3(0, omega * out, 0), v3(0, 0, -omega * out / r), 2.0 * r, 10.0 * bob);
    print_message("bobbing in a cylinder: %.1e of the energy missed in 10 bobs\n", drift);
    assert_true(fabs(drift) < 2e-5), dem_free(&w);

    start(&w, &def); /* in a cylinder that turns about its axis: the normal does not turn with it */
    const int drum = dem_add_cylinder(&w, 0, zero, v3(0, 0, 1), round, 1);
    assert_int_equal(dem_rotate(&w, drum, zero, v3(0, 0, 1), 50.0), DEM_OK);
    drift = missed_energy(&w, v3(out, 0, 0), v3(0, omega * out, 0), v3(0, 0, (50.0 * round - omega * out) / r), 2.0 * r,
                          10.0 * bob);
    print_message("in a drum that turns: %.1e\n", drift);
    assert_true(fabs(drift) < 2e-5), dem_free(&w);

    start(&w, &def); /* in a bowl, with spin about the normal */
    dem_add_sphere_wall(&w, 0, zero, round, 1);
    drift = missed_energy(&w, v3(0, 0, -b - 3e-5), v3(1.0, 0, 0), v3(0, 100.0, 300.0), 2.0 * r, 1.0);
    print_message("in a bowl: %.1e\n", drift);
    assert_true(fabs(drift) < 2e-5), dem_free(&w);

    dem_cone cone = dem_default_cone(); /* in a funnel, round and round */
    cone.low_radius = 0.02, cone.high_radius = 0.1;
    start(&w, &def);
    dem_add_cone(&w, 0, &cone);
    drift = missed_energy(&w, v3(0.042, 0, 0.05), v3(0, 1.2, 0), v3(80.0, 0, -60.0), 2.0 * r, 0.5);
    print_message("in a funnel: %.1e\n", drift);
    assert_true(fabs(drift) < 2e-5), dem_free(&w);

    for (int rim = 0; rim < 2; rim++) { /* over the outer rim of a disc, and over that of its hole, aslant */
        dem_disc disc = dem_default_disc();
        disc.radius = 0.1, disc.hole_radius = 0.03;
        start(&w, &def);
        dem_add_disc(&w, 0, &disc);
        drift = missed_energy(&w, v3(rim ? 0.034 : 0.096, 0, r - 1e-6), v3(rim ? -0.1 : 0.1, 0.08, 0),
                              v3(-8.0, rim ? -10.0 : 10.0, 200.0), 2.0 * r, 0.06);
        print_message("over a rim of a disc: %.1e\n", drift);
        assert_true(fabs(drift) < 2e-5 && dem_position(&w, 0).z < 0.99 * r), dem_free(&w);
    }

    start(&w, &def); /* over the edge of a box of triangles, aslant */
    dem_add_box(&w, 0, v3(-0.1, -0.1, -0.1), v3(0.0, 0.1, 0.0));
    drift = missed_energy(&w, v3(-0.004, 0, r - 1e-6), v3(0.1, 0.08, 0), v3(-8.0, 10.0, 200.0), 2.0 * r, 0.06);
    print_message("over an edge of triangles: %.1e\n", drift);
    assert_true(fabs(drift) < 1e-6), dem_free(&w);
}

/* ---- STL ---- */

typedef struct text {
    char bytes[200000];
    size_t size;
} text;

static void put_float(text *t, double v) {
    const float f = (float)v;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    for (int k = 0; k < 4; k++) t->bytes[t->size++] = (char)(unsigned char)(bits >> (8 * k) & 255u);
}
/* A mesh as STL, with normals times `turned`; ends: line ends of ASCII. */
static void write_stl(text *t, const dem_mesh *m, int binary, double turned, const char *head, const char *ends) {
    t->size = 0;
    memset(t->bytes, 0, 80);
    if (binary) {
        memcpy(t->bytes, head, strlen(head));
        t->size = 80;
        for (int k = 0; k < 4; k++) t->bytes[t->size++] = (char)(unsigned char)((size_t)m->triangles >> (8 * k) & 255u);
    } else t->size = (size_t)sprintf(t->bytes, "%s%s", head, ends);
    for (ptrdiff_t k = 0; k < m->triangles; k++) {
        dem_vec c[3];
        for (int a = 0; a < 3; a++) {
            const double *x = &m->vertex[3 * m->triangle[3 * k + a]];
            c[a] = v3(x[0], x[1], x[2]);
        }
        const dem_vec n = dem__scale(turned, dem__cross(dem__sub(c[1], c[0]), dem__sub(c[2], c[0])));
        if (binary) {
            put_float(t, n.x), put_float(t, n.y), put_float(t, n.z);
            for (int a = 0; a < 3; a++) put_float(t, c[a].x), put_float(t, c[a].y), put_float(t, c[a].z);
            t->bytes[t->size++] = 0, t->bytes[t->size++] = 0;
            continue;
        }
        char *to = t->bytes + t->size;
        t->size += (size_t)sprintf(to, "  facet normal %.9g %.9g %.9g%s    outer loop%s", n.x, n.y, n.z, ends, ends);
        for (int a = 0; a < 3; a++)
            t->size +=
                (size_t)sprintf(t->bytes + t->size, "      vertex %.9g %.9e %+.9f%s", c[a].x, c[a].y, c[a].z, ends);
        t->size += (size_t)sprintf(t->bytes + t->size, "    endloop%s  endfacet%s", ends, ends);
    }
    if (!binary) t->size += (size_t)sprintf(t->bytes + t->size, "endsolid%s", ends);
}

/* The box of dem_add_box as a mesh, in millimetres. */
static void cube(soup *s, double edge) {
    static const int32_t faces[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                      2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    for (int k = 0; k < 8; k++) corner(s, v3((k & 1) * edge, (k >> 1 & 1) * edge, (k >> 2) * edge));
    memcpy(s->triangle, faces, sizeof faces);
    s->mesh.triangles = 12;
    soup_mesh(s);
}

static void check_report(const dem_stl_report *r, const dem_stl_report *wanted) {
    assert_int_equal(r->binary, wanted->binary), assert_int_equal(r->facets, wanted->facets),
        assert_int_equal(r->missing, wanted->missing);
    assert_int_equal(r->not_finite, wanted->not_finite), assert_int_equal(r->degenerate, wanted->degenerate);
    assert_int_equal(r->duplicate, wanted->duplicate), assert_int_equal(r->open_edges, wanted->open_edges);
    assert_int_equal(r->nonmanifold, wanted->nonmanifold), assert_int_equal(r->inconsistent, wanted->inconsistent);
    assert_int_equal(r->wrong_normals, wanted->wrong_normals);
}

static void test_stl_of_a_cube(void **state) {
    (void)state;
    soup *s = new_soup();
    text *t = (text *)malloc(sizeof *t);
    assert_non_null(t);
    cube(s, 50.0);
    const char *heads[4] = {"solid a cube", "SOLID", "solid", "COLOR=  facet normal"},
               *ends[4] = {"\n", "\r\n", "\r", "\n\n\t"};
    for (int k = 0; k < 8; k++) {
        dem_mesh m;
        dem_stl_report r, wanted;
        memset(&wanted, 0, sizeof wanted);
        wanted.binary = k % 2, wanted.facets = 12;
        write_stl(t, &s->mesh, k % 2, 1.0, k % 2 ? heads[k / 2] : heads[k / 2 % 3], ends[k / 2]);
        assert_int_equal(dem_read_stl(t->bytes, t->size, 1e-3, k < 4 ? 0.0 : 1e-6, NULL, &m, &r), DEM_OK);
        check_report(&r, &wanted);
        assert_int_equal(m.vertices, 8), assert_int_equal(m.triangles, 12);
        near_relative(r.area, 6.0 * 0.05 * 0.05, 1e-12, "area"),
            near_relative(r.volume, 0.05 * 0.05 * 0.05, 1e-12, "volume");
        near_vec(r.low, zero, 0.0, "corner"), near_vec(r.high, v3(0.05, 0.05, 0.05), 1e-16, "corner");
        dem_world w; /* as good as the box */
        dem_def def = one_material(0.5, 0.3);
        start(&w, &def);
        const int box = wall_index(dem_add_mesh(&w, 0, &m));
        dem_free_mesh(&m), dem_free_mesh(&m);
        add(&w, v3(0.02, 0.02, 0.05 + radius - 1e-7), diameter);
        run(&w, 0.05, DEM_LINEAR | DEM_FRICTION);
        near_relative(w.wall[box].force.z, -dem_mass(&w, 0) * 9.81, 1e-3, "weight on a cube from a file");
        dem_free(&w);
    }
    free(s), free(t);
}

/* Faults, each counted: first nothing wrong, then one thing after the other. */
static void test_stl_with_faults(void **state) {
    (void)state;
    text *t = (text *)malloc(sizeof *t);
    assert_non_null(t);
    for (int fault = 0; fault < 9; fault++) {
        soup *s = new_soup();
        dem_mesh m;
        dem_stl_report r, wanted;
        double turned = 1.0, volume = 8.0;
        ptrdiff_t triangles = 12;
        cube(s, 2.0);
        memset(&wanted, 0, sizeof wanted);
        wanted.binary = 1, wanted.facets = 12;
        switch (fault) {
        case 0: turned = -1.0, wanted.wrong_normals = 12; break;
        case 1: s->mesh.triangles = triangles = 10, wanted.facets = 10, wanted.open_edges = 4, volume = nan_; break;
            /* a face away */
        case 2: facet(s, 3, 0, 2), triangles = 12, wanted.facets = 13, wanted.duplicate = 1; break;
        case 3: facet(s, 4, 4, 5), wanted.facets = 13, wanted.degenerate = 1; break;
        case 4: facet(s, 0, corner(s, v3(1, 0, 0)), 1), wanted.facets = 13, wanted.degenerate = 1; break;
            /* in a line */
        case 5: facet(s, 0, 7, corner(s, v3(nan_, 0, 0))), wanted.facets = 13, wanted.not_finite = 1; break;
        case 6: { /* one triangle turned over: three edges run the same way */
            const int32_t kept = s->triangle[1];
            s->triangle[1] = s->triangle[2], s->triangle[2] = kept;
            wanted.inconsistent = 3, volume = nan_;
            break;
        }
        case 7:
            facet(s, 0, 1, corner(s, v3(1, -1, -1))), wanted.facets = triangles = 13, wanted.nonmanifold = 1,
                                                      wanted.open_edges = 2, volume = nan_;
            break;
        default: { /* cracks of 1e-6: open without welding, closed with */
            soup *loose = new_soup();
            scene_random rr = {4};
            for (int k = 0; k < 36; k++) {
                const double *x = &s->vertex[3 * s->triangle[k]];
                const dem_vec off = scene_vector(&rr, 1e-6);
                corner(loose, dem__add(v3(x[0], x[1], x[2]), off));
                if (k % 3 == 2) facet(loose, k - 2, k - 1, k);
            }
            write_stl(t, soup_mesh(loose), 1, 1.0, "", "");
            assert_int_equal(dem_read_stl(t->bytes, t->size, 1.0, 0.0, NULL, &m, &r), DEM_OK);
            assert_int_equal(r.open_edges, 36);
            dem_free_mesh(&m);
            memcpy(s, loose, sizeof *s), free(loose), soup_mesh(s);
        }
        }
        write_stl(t, &s->mesh, 1, turned, "solid", "");
        assert_int_equal(dem_read_stl(t->bytes, t->size, 1.0, fault == 8 ? 1e-5 : 0.0, NULL, &m, &r), DEM_OK);
        check_report(&r, &wanted);
        assert_int_equal(m.triangles, triangles);
        if (fault == 8) assert_int_equal(m.vertices, 8);
        if (volume == volume) near_relative(r.volume, volume, 1e-5, "volume");
        dem_free_mesh(&m), free(s);
    }
    free(t);
}

static void test_hostile_stl(void **state) {
    (void)state;
    soup *s = new_soup();
    text *t = (text *)malloc(sizeof *t);
    dem_mesh m;
    dem_stl_report r;
    scene_random random = {9};
    assert_non_null(t);
    cube(s, 1.0);
    for (int binary = 0; binary < 2; binary++) {
        write_stl(t, &s->mesh, binary, 1.0, "solid", "\n");
        for (size_t size = 0; size < t->size; size += 1 + size / 40) { /* cut off anywhere */
            char *exact = (char *)malloc(size + 1);
            memcpy(exact, t->bytes, size);
            const dem_status status = dem_read_stl(size ? exact : NULL, size, 1.0, 1e-6, NULL, &m, &r);
            assert_true(status == DEM_OK || status == DEM_BAD_DATA);
            assert_int_equal(status == DEM_OK, r.facets > r.not_finite + r.degenerate);
            if (status == DEM_OK) assert_true(r.missing == 12 - r.facets || (!binary && r.missing <= 1));
            dem_free_mesh(&m), free(exact);
        }
    }
    /* More facets than there are bytes in the world. */
    t->bytes[80] = t->bytes[81] = t->bytes[82] = t->bytes[83] = (char)0xff;
    memset(t->bytes, ' ', 80);
    assert_int_equal(dem_read_stl(t->bytes, t->size, 1.0, 0.0, NULL, &m, &r), DEM_OK);
    assert_true(r.facets == 12 && r.missing == (ptrdiff_t)0xffffffffu - 12);
    dem_free_mesh(&m);
    const char *texts[] = {"",
                           "solid",
                           "facet",
                           "facet normal 0 0 1 vertex 1 2 vertex 1 vertex",
                           "hello world, this is a file about cats",
                           "solid\nfacet normal 0 0 1\nvertex nan 0 0\nvertex 0 1 0\nvertex 1 1 0\n",
                           "facet vertex 0 0 0 vertex 1 1 1 vertex 2 2 2 vertex 3 3 3 vertex 4 4 4",
                           "facet normal vertex vertex vertex vertex vertex 1e999 1e-999 1e vertex 1 1 1 vertex 2 3 4"};
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        assert_int_equal(dem_read_stl(texts[k], strlen(texts[k]), 1.0, 0.0, NULL, &m, &r), DEM_BAD_DATA);
        assert_true(!m.vertex && !m.triangle && !m.block && m.triangles == 0);
    }
    const char *odd = "solid x\nFACET NORMAL 0 0 0 OUTER LOOP\tVERTEX 0 0 -0.0\rVERTEX 1000000000000000000000e-21 0 0 "
                      "vertex +0 .1e+1 0. "
                      "endloop endfacet facet";
    assert_int_equal(dem_read_stl(odd, strlen(odd), 2.0, 0.0, NULL, &m, &r), DEM_OK);
    assert_int_equal(r.missing, 1), near_relative(r.area, 2.0, 1e-15, "area of a triangle in capitals");
    dem_free_mesh(&m);
    for (int k = 0; k < 20000; k++) { /* numbers as a library reads them */
        char number[64];
        const double wanted = (scene_uniform(&random) - 0.5) * pow(10.0, floor(scene_between(&random, -30, 30)));
        const int digits = 1 + (int)(17.0 * scene_uniform(&random)),
                  n = snprintf(number, sizeof number, k % 2 ? "%.*g" : "%.*e", digits, wanted);
        near_relative(dem__number((const unsigned char *)number, (size_t)n), strtod(number, NULL), 4e-16, number);
    }
    write_stl(t, &s->mesh, 1, 1.0, "", "");
    assert_int_equal(dem_read_stl(NULL, 5, 1.0, 0.0, NULL, &m, &r), DEM_BAD_ARGUMENT);
    const double bad[4] = {0.0, -1.0, nan_, inf};
    for (int k = 0; k < 4; k++)
        assert_int_equal(dem_read_stl(t->bytes, t->size, bad[k], 0.0, NULL, &m, &r), DEM_BAD_ARGUMENT);
    for (int k = 1; k < 4; k++)
        assert_int_equal(dem_read_stl(t->bytes, t->size, 1.0, bad[k], NULL, &m, &r), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_read_stl(t->bytes, t->size, 1.0, 0.0, NULL, NULL, &r), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_read_stl(t->bytes, t->size, 1e300, 0.0, NULL, &m, &r), DEM_BAD_DATA),
        assert_true(r.not_finite > 0);
    assert_int_equal(dem_read_stl(t->bytes, t->size, 1e-300, 0.0, NULL, &m, &r), DEM_BAD_DATA);
    assert_int_equal(dem_read_stl(t->bytes, t->size, 1.0, 1e30, NULL, &m, NULL), DEM_BAD_DATA); /* all one vertex */
    failing_allocator memory;
    dem_allocator hook = {failing_fn, NULL};
    hook.user = &memory;
    for (int k = 0; k < 3; k++) {
        failing_init_at(&memory, k);
        assert_int_equal(dem_read_stl(t->bytes, t->size, 1.0, 0.0, &hook, &m, &r), k < 2 ? DEM_OUT_OF_MEMORY : DEM_OK);
        dem_free_mesh(&m);
        assert_int_equal(failing_live(&memory), 0);
    }
    free(s), free(t);
}

/* Walls that vibrate alike share their sines; each is where its own formula says. */
static void test_vibrating_together(void **state) {
    (void)state;
    static const struct {
        dem_vec amplitude, phase;
        double frequency;
    } motion[] = {{{1e-4, 0, 9e-4}, {1.5, 0, 0}, 50.0},   {{1e-4, 0, 9e-4}, {1.5, 0, 0}, 50.0},
                  {{1e-4, 0, 9e-4}, {1.5, 0, 0}, 51.0},   {{1e-4, 0, 8e-4}, {1.5, 0, 0}, 51.0},
                  {{1e-4, 0, 8e-4}, {1.4, 0, 0}, 51.0},   {{1e-4, 0, 8e-4}, {1.4, 0, 0}, 51.0},
                  {{0, 1e-3, 8e-4}, {0.2, -0.3, 2}, 51.0}};
    enum { WALLS = sizeof motion / sizeof *motion };
    dem_world w;
    dem_def def = one_material(0.5, 0.3);
    start(&w, &def);
    for (int k = 0; k < WALLS; k++) {
        wall_index(dem_add_plane(&w, 0, v3(0, 0, -0.1 * k), up));
        assert_int_equal(dem_vibrate(&w, k, motion[k].amplitude, motion[k].phase, motion[k].frequency), DEM_OK);
    }
    run(&w, 0.0123, DEM_LINEAR);
    for (int k = 0; k < WALLS; k++) {
        const double rate = 2.0 * RIDDLE_PI * motion[k].frequency;
        for (int a = 0; a < 3; a++) {
            const double amplitude = dem_axis(motion[k].amplitude, a), phase = dem_axis(motion[k].phase, a),
                         angle = rate * w.time + phase;
            const double from = a == 2 ? -0.1 * k : 0.0;
            near_absolute(dem_axis(w.wall[k].position, a) - from, amplitude * (sin(angle) - sin(phase)), 1e-15,
                          "place");
            near_absolute(dem_axis(w.wall[k].velocity, a), amplitude * rate * cos(angle), 1e-12, "velocity");
            near_absolute(dem_axis(w.wall[k].acceleration, a), -amplitude * rate * rate * sin(angle), 1e-10,
                          "acceleration");
        }
    }
    dem_free(&w);
}

/* ---- STL as programs write it: the same geometry, or a status or report that says what is wrong ---- */

static const double tetra[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const int tetra_face[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

/* A tetrahedron of volume 1/6 as text. */
static void write_tetra(text *t, const char *head, const char *facet_, const char *vertex_, const char *ends,
                        const char *tail) {
    t->size = (size_t)sprintf(t->bytes, "%s%s", head, ends);
    for (int k = 0; k < 4; k++) {
        t->size += (size_t)sprintf(t->bytes + t->size, "%s 0 0 0%souter loop%s", facet_, ends, ends);
        for (int c = 0; c < 3; c++) {
            const double *x = tetra[tetra_face[k][c]];
            t->size += (size_t)sprintf(t->bytes + t->size, "  %s %g %g %g%s", vertex_, x[0], x[1], x[2], ends);
        }
        t->size += (size_t)sprintf(t->bytes + t->size, "endloop%sendfacet%s", ends, ends);
    }
    t->size += (size_t)sprintf(t->bytes + t->size, "%s%s", tail, ends);
}
static void write_tetra_binary(text *t, const char *head, uint32_t count, int facets, size_t behind) {
    memset(t->bytes, 0, 400);
    memcpy(t->bytes, head, strlen(head));
    for (int k = 0; k < 4; k++) t->bytes[80 + k] = (char)(unsigned char)(count >> (8 * k) & 255u);
    t->size = 84;
    for (int k = 0; k < facets; k++) {
        t->size += 12;
        for (int c = 0; c < 9; c++) put_float(t, tetra[tetra_face[k % 4][c / 3]][c % 3]);
        t->size += 2;
    }
    memset(t->bytes + t->size, 7, behind);
    t->size += behind;
}

/* 1: the tetrahedron and nothing told; 2: the tetrahedron, and something told; 3: other geometry, which is told; 4:
   refused; 0: wrong */
static int outcome(const text *t) {
    dem_mesh m;
    dem_stl_report r;
    const dem_status status = dem_read_stl(t->bytes, t->size, 1.0, 0.0, NULL, &m, &r);
    const int right = status == DEM_OK && m.triangles == 4 && fabs(r.volume - 1.0 / 6.0) < 1e-9 && r.open_edges == 0;
    const int told = r.missing > 0 || r.not_finite > 0 || r.unannounced > 0 || r.surplus > 0;
    dem_free_mesh(&m);
    if (status != DEM_OK) {
        assert_int_equal(status, DEM_BAD_DATA);
        assert_non_null(strstr(dem_status_text(status), "STL"));
        return 4;
    }
    return right ? 1 + told : told ? 3 : 0;
}

static void test_stl_variants(void **state) {
    (void)state;
    text *t = (text *)malloc(sizeof *t);
    assert_non_null(t);
    static const struct {
        const char *head, *facet, *vertex, *ends, *tail;
        int outcome;
    } texts[] = {
        {"solid t", "facet normal", "vertex", "\n", "endsolid t", 1},
        {"\xEF\xBB\xBFsolid t", "facet normal", "vertex", "\n", "endsolid t", 1},
        {"# facet normal 1 2 3\nsolid", "facet normal", "vertex", "\n", "endsolid", 1},
        {"\n \n\tsolid t", "facet normal", "vertex", "\r\n", "endsolid t", 1},
        {"", "facet normal", "vertex", "\n", "", 1},
        {"solid_part1", "facet normal", "vertex", "\n", "endsolid_part1", 1},
        {"SOLID T", "FACET NORMAL", "VERTEX", "\r", "ENDSOLID T", 1},
        {"solid facet normal vertex 1 2 3", "facet normal", "vertex", "\n", "endsolid facet normal vertex 1 2 3", 1},
        {"solid in one line", "facet normal", "vertex", " ", "endsolid in one line", 1},
        {"solid Gef\xE4\xDF", "facet normal", "vertex", "\n", "endsolid Gef\xE4\xDF\n\x1a", 1},
        {"solid t", "facet normal", "vertex", "\n", "end solid", 1},
        {"solid t", "facet normal", "vertex", "\n", "", 2},             /* broken off between two facets */
        {"solid t", "facet normal", "vertex 0.5", "\n", "endsolid", 4}, /* four numbers */
        {"solid t", "facet normal", "vertex,", "\n", "endsolid", 4},
        {"<html><body>solid t<br>", "facet normal", "<b>vertex</b>", "<br>\n", "</html>", 4},
        {"<html><body>not found</body></html>", "f", "v", "\n", "", 4},
    };
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        write_tetra(t, texts[k].head, texts[k].facet, texts[k].vertex, texts[k].ends, texts[k].tail);
        if (outcome(t) != texts[k].outcome) fail_msg("text %d: outcome %d", (int)k, outcome(t));
    }
    static const struct {
        const char *head;
        uint32_t count;
        int facets, behind, outcome;
    } binaries[] = {{"solid made binary", 4, 4, 0, 1},
                    {"COLOR=", 4, 4, 0, 1},
                    {"solid facet normal vertex 1 2 3", 4, 4, 0, 1},
                    {"", 0, 4, 0, 2},
                    {"", 0xffffffffu, 4, 0, 2},
                    {"", 2, 4, 0, 2},
                    {"", 4, 4, 13, 2},
                    {"", 4, 4, 230, 2},
                    {"", 4, 3, 0, 3},
                    {"", 4, 3, 49, 3},
                    {"", 4u << 24, 0, 200, 4},
                    {"", 4, 0, 0, 4}};
    for (size_t k = 0; k < sizeof binaries / sizeof *binaries; k++) {
        write_tetra_binary(t, binaries[k].head, binaries[k].count, binaries[k].facets, (size_t)binaries[k].behind);
        if (outcome(t) != binaries[k].outcome) fail_msg("binary %d: outcome %d", (int)k, outcome(t));
    }
    for (int little = 0; little < 2; little++) { /* UTF-16, with and without its mark */
        for (int mark = 0; mark < 2; mark++) {
            text *wide = (text *)malloc(sizeof *wide);
            assert_non_null(wide);
            write_tetra(t, "solid t", "facet normal", "vertex", "\r\n", "endsolid t");
            wide->size = 0;
            if (mark)
                wide->bytes[wide->size++] = (char)(little ? 0xff : 0xfe),
                wide->bytes[wide->size++] = (char)(little ? 0xfe : 0xff);
            for (size_t k = 0; k < t->size; k++)
                wide->bytes[wide->size++] = little ? t->bytes[k] : 0,
                wide->bytes[wide->size++] = little ? 0 : t->bytes[k];
            assert_int_equal(outcome(wide), 4);
            free(wide);
        }
    }
    scene_random r = {5};
    for (int k = 0; k < 2000; k++) { /* a zip, a picture: noise behind any head */
        t->size = (size_t)scene_between(&r, 90.0, 3000.0);
        for (size_t b = 0; b < t->size; b++) t->bytes[b] = (char)(unsigned char)(256.0 * scene_uniform(&r));
        memcpy(t->bytes, "PK\3\4", 4);
        assert_int_equal(outcome(t), 4);
    }
    write_tetra(t, "solid t", "facet normal", "vertex", "\n", "endsolid t");
    for (size_t size = 0; size < t->size - 1; size++) { /* cut off anywhere: never another geometry without a word */
        text cut = *t;
        cut.size = size;
        const int of = outcome(&cut);
        if (!(of == 2 || of == 3 || of == 4 || (of == 1 && size > t->size - 12))) /* within the last line */
            fail_msg("cut to %d of %d: outcome %d", (int)size, (int)t->size, of);
    }
    free(t);
}

static void put_polygon(text *t, int n, double (*x)[3]) {
    t->size += (size_t)sprintf(t->bytes + t->size, "facet normal 0 0 0\nouter loop\n");
    for (int k = 0; k < n; k++)
        t->size += (size_t)sprintf(t->bytes + t->size, "vertex %g %g %g\n", x[k][0], x[k][1], x[k][2]);
    t->size += (size_t)sprintf(t->bytes + t->size, "endloop\nendfacet\n");
}

/* Prisms over polygons: right volume and area, and closed; a polygon that no fan covers is counted as missing. */
static void test_stl_polygons(void **state) {
    (void)state;
    text *t = (text *)malloc(sizeof *t);
    assert_non_null(t);
    static const double quad[4][2] = {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, arrow[4][2] = {{0, 0}, {2, 2}, {0, 1}, {-2, 2}},
                        ell[6][2] = {{1, 2}, {0, 2}, {0, 0}, {2, 0}, {2, 1}, {1, 1}},
                        comb[8][2] = {{0, 0}, {5, 0}, {5, 3}, {4, 3}, {4, 1}, {1, 1}, {1, 3}, {0, 3}};
    static const struct {
        const double (*x)[2];
        int n, missing;
        double area;
    } shapes[] = {{quad, 4, 0, 2.0}, {arrow, 4, 0, 2.0}, {ell, 6, 0, 3.0}, {comb, 8, 2, 9.0}};
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        double floor_[8][3], roof[8][3];
        const int n = shapes[s].n;
        dem_mesh m;
        dem_stl_report r;
        t->size = (size_t)sprintf(t->bytes, "solid\n");
        for (int k = 0; k < n; k++) {
            const double *low = shapes[s].x[n - 1 - k], *high = shapes[s].x[k], *next = shapes[s].x[(k + 1) % n];
            double side[4][3] = {
                {high[0], high[1], 0}, {next[0], next[1], 0}, {next[0], next[1], 1}, {high[0], high[1], 1}};
            floor_[k][0] = low[0], floor_[k][1] = low[1], floor_[k][2] = 0;
            roof[k][0] = high[0], roof[k][1] = high[1], roof[k][2] = 1;
            put_polygon(t, 4, side);
        }
        put_polygon(t, n, floor_), put_polygon(t, n, roof);
        t->size += (size_t)sprintf(t->bytes + t->size, "endsolid\n");
        assert_int_equal(dem_read_stl(t->bytes, t->size, 1.0, 0.0, NULL, &m, &r), DEM_OK);
        assert_int_equal(r.missing, shapes[s].missing), assert_int_equal(r.polygons, n + 2 - shapes[s].missing);
        if (!shapes[s].missing) {
            assert_int_equal(r.open_edges, 0), assert_int_equal(r.inconsistent, 0),
                assert_int_equal(m.triangles, 2 * n + 2 * (n - 2));
            near_relative(r.volume, shapes[s].area, 1e-12, "volume of a prism");
        } else assert_true(r.open_edges > 0);
        dem_free_mesh(&m);
    }
    free(t);
}

/* A cube one of whose edges is cut by corners of its neighbours: facets without area close it, however many, in
   whatever order. */
static void test_stl_junctions(void **state) {
    (void)state;
    text *t = (text *)malloc(sizeof *t);
    assert_non_null(t);
    for (int cuts = 1; cuts < 6; cuts++) {
        for (int closed = 0; closed < 3; closed++) { /* without those facets; with; with, the other way round */
            soup *s = new_soup();
            int32_t before = 0;
            dem_mesh m;
            dem_stl_report r;
            cube(s, 1.0);
            s->mesh.triangles = 12;
            /* the floor's triangle (0, 3, 1) becomes a fan from 3 over points of the edge 0-1; that of
               the side stays */
            s->triangle[4] = 3, s->triangle[5] = corner(s, v3(1.0 / (cuts + 1), 0, 0));
            before = s->triangle[5];
            const int32_t first = before;
            for (int k = 2; k <= cuts + 1; k++) {
                const int32_t next = k == cuts + 1 ? 1 : corner(s, v3((double)k / (cuts + 1), 0, 0));
                facet(s, before, 3, next);
                if (closed == 1) facet(s, 0, before, next);
                before = next;
            }
            for (int k = cuts + 1; k >= 2 && closed == 2; k--)
                facet(s, 0, first + k - 2, k == cuts + 1 ? 1 : first + k - 1);
            write_stl(t, soup_mesh(s), 1, 1.0, "", "");
            assert_int_equal(dem_read_stl(t->bytes, t->size, 1.0, 0.0, NULL, &m, &r), DEM_OK);
            assert_int_equal(r.degenerate, closed ? cuts : 0);
            assert_int_equal(r.open_edges, closed ? 0 : cuts + 2);
            assert_int_equal(r.nonmanifold + r.inconsistent, 0);
            near_relative(r.volume, 1.0, 1e-6, "volume");
            dem_free_mesh(&m), free(s);
        }
    }
    free(t);
}

/* One corner far out: the others are welded as before, and not each compared with all, which would take minutes. */
static void test_stl_stray_vertex(void **state) {
    (void)state;
    const int n = 200000;
    const size_t size = 84 + 50 * (size_t)n;
    unsigned char *bytes = (unsigned char *)calloc(size, 1);
    assert_non_null(bytes);
    const uint32_t count = (uint32_t)n;
    memcpy(bytes + 80, &count, 4);
    for (int k = 0; k < n; k++) {
        for (int c = 0; c < 9; c++) {
            /* a strip */
            float v = (float)(c % 3 == 0 ? k / 2 + (c / 3 + k % 2) / 2 : c % 3 == 1 ? (c / 3 + k) % 2 : 0);
            if (k == n - 1 && c == 8) v = 1e30f;
            memcpy(bytes + 84 + 50 * (size_t)k + 12 + 4 * c, &v, 4);
        }
    }
    for (int weld = 0; weld < 2; weld++) {
        dem_mesh m;
        dem_stl_report r;
        assert_int_equal(dem_read_stl(bytes, size, 1e-3, weld ? 1e-6 : 0.0, NULL, &m, &r), DEM_OK);
        assert_true(m.vertices > n && m.vertices < n + 4), assert_true(r.high.z > 1e26);
        dem_free_mesh(&m);
    }
    free(bytes);
}

/* A drum that turns about its axis and vibrates: its motion changes in mid-swing, and it goes on about its axis. */
static void test_axis_goes_with_the_vibration(void **state) {
    (void)state;
    for (int change = 0; change < 4; change++) {
        dem_def def = one_material(0.5, 0.3);
        dem_world w;
        start(&w, &def);
        const int drum = wall_index(dem_add_cylinder(&w, 0, v3(0.1, 0, 0), v3(0, 1, 0), 0.05, 1));
        assert_int_equal(dem_rotate(&w, drum, v3(0.1, 0, 0), v3(0, 1, 0), 10.0), DEM_OK);
        assert_int_equal(dem_vibrate(&w, drum, v3(0, 0, 2e-3), zero, 10.0), DEM_OK);
        run(&w, 0.02, DEM_LINEAR);
        const double z = 2e-3 * sin(2.0 * RIDDLE_PI * 10.0 * 0.02);
        near_absolute(w.wall[drum].position.z, z, 1e-12, "drum before the change");
        if (change == 0) assert_int_equal(dem_vibrate(&w, drum, zero, zero, 10.0), DEM_OK);
        if (change == 1) assert_int_equal(dem_move(&w, drum, v3(0, 0, 0.01)), DEM_OK);
        if (change == 2) assert_int_equal(dem_vibrate(&w, drum, v3(0, 0, 1e-3), zero, 20.0), DEM_OK);
        if (change == 3)
            assert_int_equal(dem_move(&w, drum, v3(0.01, 0, 0)), DEM_OK), run(&w, 0.01, DEM_LINEAR),
                assert_int_equal(dem_vibrate(&w, drum, zero, zero, 0.0), DEM_OK);
        for (int k = 1; k < 5; k++) {
            run(&w, 0.137, DEM_LINEAR);
            const double x = change == 3 ? 0.1 + 0.01 * (w.time - 0.02) : 0.1;
            near_absolute(w.wall[drum].position.x, x, 1e-12, "a drum that turns about its axis");
            if (change == 0) near_absolute(w.wall[drum].position.z, z, 1e-12, "a drum that has stopped");
        }
        dem_free(&w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mesh_distance),
        cmocka_unit_test(test_cone_and_sphere_distance),
        cmocka_unit_test(test_disc_distance),
        cmocka_unit_test(test_disc_bottom),
        cmocka_unit_test(test_triangles_equal_the_plane),
        cmocka_unit_test(test_bad_triangles_equal_the_plane),
        cmocka_unit_test(test_round_drum),
        cmocka_unit_test(test_fine_bowl),
        cmocka_unit_test(test_convex_edge),
        cmocka_unit_test(test_concave_corner),
        cmocka_unit_test(test_one_place_of_many),
        cmocka_unit_test(test_ball_in_a_cone),
        cmocka_unit_test(test_bouncing_in_a_bowl),
        cmocka_unit_test(test_prescribed_motion),
        cmocka_unit_test(test_vibrating_together),
        cmocka_unit_test(test_piston),
        cmocka_unit_test(test_piston_momentum),
        cmocka_unit_test(test_rotor),
        cmocka_unit_test(test_belt),
        cmocka_unit_test(test_belt_around_an_axis),
        cmocka_unit_test(test_work_of_walls),
        cmocka_unit_test(test_torque_of_a_drum),
        cmocka_unit_test(test_skipping_changes_nothing),
        cmocka_unit_test(test_saving),
        cmocka_unit_test(test_unsound_walls),
        cmocka_unit_test(test_rim),
        cmocka_unit_test(test_out_of_memory),
        cmocka_unit_test(test_bad_arguments),
        cmocka_unit_test(test_rolling_keeps_its_energy),
        cmocka_unit_test(test_stl_of_a_cube),
        cmocka_unit_test(test_stl_with_faults),
        cmocka_unit_test(test_hostile_stl),
        cmocka_unit_test(test_stl_variants),
        cmocka_unit_test(test_axis_goes_with_the_vibration),
        cmocka_unit_test(test_stl_polygons),
        cmocka_unit_test(test_stl_junctions),
        cmocka_unit_test(test_stl_stray_vertex),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
