/* dem_make_clump_from_mesh: mass properties are those of the surface, spheres stay inside it, and concave bodies
   rest and hook. */
#include "dem.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#include "failing_allocator.h"
#include "near.h"

enum { ROUND = 48, TUBE = 24 };
static double vertex[ROUND * TUBE * 3];
static int32_t triangle[2 * ROUND * TUBE * 3];

static dem_mesh mesh_of(ptrdiff_t vertices, ptrdiff_t triangles) {
    dem_mesh m;
    memset(&m, 0, sizeof m);
    m.vertices = vertices, m.triangles = triangles, m.vertex = vertex, m.triangle = triangle;
    return m;
}
static void put(int k, int a, int b, int c) { triangle[3 * k] = a, triangle[3 * k + 1] = b, triangle[3 * k + 2] = c; }

/* A prism over an L: arms `along` and `up` long and 1 wide, 1 thick; `up` = 1: a bar. The origin is the
   outer corner. */
static dem_mesh prism(double along, double up) {
    const double x[6][2] = {{0, 0}, {along, 0}, {along, 1}, {1, 1}, {1, up}, {0, up}};
    static const int cap[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}};
    for (int k = 0; k < 12; k++)
        vertex[3 * k] = x[k % 6][0], vertex[3 * k + 1] = k / 6, vertex[3 * k + 2] = x[k % 6][1];
    for (int k = 0; k < 4; k++) {
        put(k, cap[k][0], cap[k][1], cap[k][2]);
        put(4 + k, 6 + cap[k][0], 6 + cap[k][2], 6 + cap[k][1]);
    }
    for (int k = 0; k < 6; k++)
        put(8 + 2 * k, k, k + 6, (k + 1) % 6), put(9 + 2 * k, (k + 1) % 6, k + 6, (k + 1) % 6 + 6);
    return mesh_of(12, 20);
}
static dem_mesh box(double a, double b, double c) {
    static const int side[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    for (int k = 0; k < 8; k++)
        vertex[3 * k] = a * (k & 1), vertex[3 * k + 1] = b * (k >> 1 & 1), vertex[3 * k + 2] = c * (k >> 2);
    for (int k = 0; k < 12; k++) put(k, side[k][0], side[k][1], side[k][2]);
    return mesh_of(8, 12);
}
static dem_mesh torus(double big, double small) {
    const double pi = 3.14159265358979323846;
    for (int i = 0; i < ROUND; i++) {
        for (int j = 0; j < TUBE; j++) {
            const double a = 2 * pi * i / ROUND, b = 2 * pi * j / TUBE, r = big + small * cos(b);
            const int k = i * TUBE + j, right = (i + 1) % ROUND * TUBE + j, up = i * TUBE + (j + 1) % TUBE,
                      both = (i + 1) % ROUND * TUBE + (j + 1) % TUBE;
            vertex[3 * k] = r * cos(a), vertex[3 * k + 1] = r * sin(a), vertex[3 * k + 2] = small * sin(b);
            put(2 * k, k, right, both), put(2 * k + 1, k, both, up);
        }
    }
    return mesh_of(ROUND * TUBE, 2 * ROUND * TUBE);
}

/* A cube: one sphere fills what a ball fills; more fill more; moments stay exact, whatever the number. */
static void test_cube(void **state) {
    (void)state;
    dem_mesh m = box(2e-3, 2e-3, 2e-3);
    dem_clump c;
    dem_clump_fit fit;
    static const double lacks[4] = {-0.476, -0.397, -0.224, -0.112};
    double before = -1.0;
    for (int n = 1, at = 0; n <= 64; n *= 4, at++) {
        assert_int_equal(dem_make_clump_from_mesh(&m, n, NULL, &c, &fit), DEM_OK);
        assert_true(c.spheres <= n && fit.volume > before && fit.volume < 0.0);
        before = fit.volume;
        near(fit.volume, lacks[at], 0.003);
        near(c.volume, 8e-9, 8e-22);
        near(c.moments.x, 8e-9 * 8e-6 / 12, 1e-26), near(c.moments.z, 8e-9 * 8e-6 / 12, 1e-26);
        near(c.origin.x, 1e-3, 1e-16), near(c.origin.y, 1e-3, 1e-16), near(c.origin.z, 1e-3, 1e-16);
        near(c.radius[0], 1e-3, 1e-15), near(dem_clump_diameter(&c), 2e-3 * 1.2407009817988, 1e-14);
        for (int k = 0; k < c.spheres; k++) {
            for (int a = 0; a < 3; a++) assert_true(fabs(dem_axis(c.centre[k], a)) + c.radius[k] <= 1e-3 * (1 + 1e-12));
        }
        printf("cube, %d spheres: volume %+.3f, moments %.3f\n", c.spheres, fit.volume, fit.moments);
        if (n == 1) near(fit.volume, 0.52359877559830 - 1, 1e-12), near(fit.centre, 0, 1e-12);
    }
}

/* An L: mass properties of two boxes; the same whatever the unit, the place and the way in which triangles face. */
static void test_ell(void **state) {
    (void)state;
    dem_mesh m = prism(4, 3);
    dem_clump c, other;
    dem_clump_fit fit, same;
    assert_int_equal(dem_make_clump_from_mesh(&m, 30, NULL, &c, &fit), DEM_OK);
    const double x = (4 * 2 + 2 * 0.5) / 6, z = (4 * 0.5 + 2 * 2) / 6, about_y = 4 * (17.0 / 12) + 2 * (5.0 / 12) +
                 4 * ((x - 2) * (x - 2) + (z - 0.5) * (z - 0.5)) + 2 * ((x - 0.5) * (x - 0.5) + (z - 2) * (z - 2));
    near(c.volume, 6, 1e-13), near(c.origin.x, x, 1e-14), near(c.origin.y, 0.5, 1e-14), near(c.origin.z, z, 1e-14);
    near(fmax(c.moments.x, fmax(c.moments.y, c.moments.z)), about_y, 1e-12);
    near(c.moments.x + c.moments.y + c.moments.z, 2 * about_y + 2 * 6 * 1.0 / 12, 1e-12);
    printf("L, %d spheres: volume %+.3f, moments %.3f, centre %.4f\n", c.spheres, fit.volume, fit.moments, fit.centre);
    near(fit.volume, -0.259, 0.003), assert_true(fit.moments < 0.3 && fit.centre < 0.05);
    for (int k = 0; k < c.spheres; k++) { /* none bridges the inner corner */
        const double at_x = c.centre[k].x + x, at_z = c.centre[k].z + z, r = c.radius[k] * (1 - 1e-12);
        assert_true(at_x - r >= 0 && at_z - r >= 0 && at_x + r <= 4 && at_z + r <= 3);
        assert_true(at_x + r <= 1 || at_z + r <= 1 || (at_x - 1) * (at_x - 1) + (at_z - 1) * (at_z - 1) >= r * r);
    }
    for (int k = 0; k < 20; k++) put(k, triangle[3 * k + 1], triangle[3 * k], triangle[3 * k + 2]);
    for (int k = 0; k < 36; k++) vertex[k] = 1e-3 * vertex[k] + 7e-3;
    assert_int_equal(dem_make_clump_from_mesh(&m, 30, NULL, &other, &same), DEM_OK);
    assert_int_equal(other.spheres, c.spheres);
    near(other.volume, 6e-9, 1e-20), near(other.moments.x, 1e-15 * c.moments.x, 1e-25),
        near(same.volume, fit.volume, 1e-6);
}

/* A torus: the hole stays open. A surface with a hole is refused, and so are other bad arguments. */
static void test_torus(void **state) {
    (void)state;
    dem_mesh m = torus(3e-3, 1e-3);
    dem_clump c;
    dem_clump_fit fit;
    assert_int_equal(dem_make_clump_from_mesh(&m, 40, NULL, &c, &fit), DEM_OK);
    near(c.volume / (2 * 9.8696044010894 * 3e-9), 1, 0.03);
    near(c.moments.x / c.moments.y, 1, 1e-9);
    near(fit.volume, -0.083, 0.003), assert_true(fit.centre < 0.01);
    printf("torus, %d spheres: volume %+.3f, moments %.3f, centre %.4f\n", c.spheres, fit.volume, fit.moments,
           fit.centre);
    for (int k = 0; k < c.spheres; k++) assert_true(dem__length(c.centre[k]) - c.radius[k] > 1.95e-3);
    assert_int_equal(dem_make_clump_from_mesh(&m, 0, NULL, &c, &fit), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_make_clump_from_mesh(&m, DEM_CLUMP_MAX + 1, NULL, &c, NULL), DEM_TOO_MANY);
    assert_int_equal(dem_make_clump_from_mesh(NULL, 4, NULL, &c, NULL), DEM_BAD_ARGUMENT);
    m.triangles--;
    assert_int_equal(dem_make_clump_from_mesh(&m, 4, NULL, &c, NULL), DEM_BAD_ARGUMENT);
}

static void test_memory(void **state) {
    (void)state;
    dem_mesh m = prism(4, 3);
    dem_allocator a;
    dem_clump c;
    int failures = 0;
    for (;; failures++) {
        failing_allocator memory;
        failing_init_at(&memory, failures);
        memset(&a, 0, sizeof a), a.fn = failing_fn, a.user = &memory;
        const dem_status status = dem_make_clump_from_mesh(&m, 2, &a, &c, NULL);
        assert_int_equal(failing_live(&memory), 0);
        if (status == DEM_OK) break;
        assert_int_equal(status, DEM_OUT_OF_MEMORY);
    }
    assert_true(failures >= 4);
}

/* An L comes to rest flat on a floor without a spin. Another one hangs on a bar by its short arm and is pulled against
   it; a bar slides off. */
static void test_hook(void **state) {
    (void)state;
    dem_mesh m = prism(4, 3);
    dem_def def = dem_default_def();
    dem_clump ell, bar;
    dem_world w;
    const int s = dem_add_material(&def, 1000.0, 1e7, 0.3);
    dem_pair_def *p = dem_pair(&def, s, s);
    p->stiffness = 1e8, p->restitution = 0.3, p->friction = 0.1;
    assert_int_equal(dem_make_clump_from_mesh(&m, 40, NULL, &ell, NULL), DEM_OK);
    m = box(4, 1, 1);
    assert_int_equal(dem_make_clump_from_mesh(&m, 40, NULL, &bar, NULL), DEM_OK);
    for (int hooks = 0; hooks < 2; hooks++) {
        /* the fixed one lies along x from 0 to 4; the other one lies on it, its short arm down beyond 4 */
        const dem_clump *hung = hooks ? &ell : &bar;
        const dem_vec o = hung->origin; /* from the outer corner */
        const double fixed[3] = {2, 0.5, 0.5}, flat[3] = {20, 0, -9.48};
        const double on[3] = {5.02 - o.x, 0.5, 2.0 - o.z}, turned[4] = {0, 0, 1, 0}, lying[4] = {1, 1, 0, 0};
        def.dt = 2e-4, def.gravity = dem_vec3(0, 0, -10);
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        assert_true(dem_add_plane(&w, s, dem_vec3(0, 0, -10), dem_vec3(0, 0, 1)) >= 0);
        assert_int_equal(dem_add_clumps(&w, 1, &bar, fixed, NULL, NULL, s, 0), DEM_OK);
        assert_int_equal(dem_fix(&w, 0, 1), DEM_OK);
        const ptrdiff_t second = w.count;
        assert_int_equal(dem_add_clumps(&w, 1, hung, on, NULL, turned, s, 0), DEM_OK);
        const ptrdiff_t third = w.count;
        assert_int_equal(dem_add_clumps(&w, 1, &ell, flat, NULL, lying, s, 0), DEM_OK);
        assert_int_equal(dem_run(&w, 1.0, DEM_LINEAR | DEM_FRICTION), DEM_OK);
        const dem_vec spin = dem_spin(&w, third);
        assert_true(dem__length(spin) < 1e-4);
        dem_body body = dem_get_body(&w, third);
        near(body.position.z, -9.5, 2e-3);
        assert_int_equal(dem_set_gravity(&w, dem_vec3(-4, 0, -10)), DEM_OK);
        assert_int_equal(dem_run(&w, 1.0, DEM_LINEAR | DEM_FRICTION), DEM_OK);
        body = dem_get_body(&w, second);
        const double moved = fabs(body.position.x - on[0]) + fabs(body.position.z - on[2]);
        printf("%s: moved by %.3f\n", hooks ? "hook" : "bar", moved);
        assert_true(hooks ? moved < 0.3 : moved > 1.0);
        dem_free(&w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_cube), cmocka_unit_test(test_ell),
                                       cmocka_unit_test(test_torus), cmocka_unit_test(test_memory),
                                       cmocka_unit_test(test_hook)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
