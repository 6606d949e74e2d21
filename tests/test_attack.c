/* What random programs, failing memory and hostile numbers have found (issue 42): each fault, held down. */
#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#include "classifier.h"
#include "dem_changes.h"
#include "dem_scenes.h"
#include "failing_allocator.h"

/* ---- memory ---- */

/* Laws with different numbers of states, in turn, while nothing touches: the arrays of contacts change, their
   room does not. */
static void test_laws_in_turn(void **state) {
    (void)state;
    failing_allocator memory;
    dem_def def = scene_def(4e-6);
    dem_world w;
    const double at[3] = {0, 0, 0}, d = 1e-3;
    size_t early = 0;
    failing_init(&memory);
    def.allocator.fn = failing_fn, def.allocator.user = &memory;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 1, at, &d, 0, 0), DEM_OK);
    for (int k = 0; k < 60; k++) {
        static const int features[] = {DEM_LINEAR, DEM_LINEAR | DEM_ENERGY, DEM_HERTZ | DEM_FRICTION, DEM_HERTZ};
        assert_int_equal(dem_run(&w, 1e-5, features[k % 4]), DEM_OK);
        if (k == 8) early = memory.live_bytes;
    }
    assert_true(memory.live_bytes == early && memory.peak_bytes < 1000000);
    dem_free(&w);
    assert_int_equal(failing_live(&memory), 0);
}

/* A search over models, each of which may run out of memory: the first failure is the answer. */
static void test_lost_status(void **state) {
    (void)state;
    classifier_def def = classifier_default_def();
    int tried = 0;
    def.points = 64;
    for (int k = -1, allocations = 1; k < allocations; k++) {
        failing_allocator memory;
        classifier_memory hook = {failing_fn, &memory};
        double rpm = 0.0;
        failing_init_at(&memory, k), memory.fail_count = 1;
        const classifier_status status = classifier_rpm_for(&def, 3e-5, &hook, &rpm);
        if (k < 0) allocations = memory.calls;
        else tried++;
        assert_int_equal(status, k < 0 ? CLASSIFIER_OK : CLASSIFIER_OUT_OF_MEMORY);
        assert_int_equal(failing_live(&memory), 0);
    }
    assert_true(tried > 3);
}

/* ---- links ---- */

static const dem_law spring = {"spring", 1, SPRING_STATES, 0, 0, 0, NULL, scene_spring_force, NULL, NULL};
DEM_LINK_KERNEL(spring_kernel, spring)

/* A linked sphere leaves by an exit between two evaluations of its link: the work is booked once. */
static void test_link_work_after_exit(void **state) {
    (void)state;
    const double at[6] = {0, 0, 0, 0, 1e-3, 2e-3}, d[2] = {1e-3, 1e-3}, weak[SPRING_STATES] = {0.05, 1.0, 0.0};
    const dem_vec down = dem_vec3(0, 0, -1.0), none = dem_vec3(0, 0, 0);
    dem_def def = scene_def(1e-5);
    dem_world w;
    def.gravity = none;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 2, at, d, 0, 0), DEM_OK);
    assert_int_equal(dem_set_motion(&w, 0, down, none), DEM_OK);
    assert_int_equal(dem_set_motion(&w, 1, down, none), DEM_OK);
    assert_true(dem_add_exit(&w, dem_vec3(0, 0, -0.00355), dem_vec3(0, 0, 1)) >= 0);
    assert_int_equal(dem_set_links(&w, &spring_kernel, 2e-4, 0.0), DEM_OK); /* every 20 steps */
    assert_int_equal(dem_add_link(&w, 0, 1, 0, weak), DEM_OK);
    for (int n = 0; n < 60; n++) {
        assert_int_equal(dem_run(&w, 1e-4, DEM_LINEAR | DEM_ENERGY), DEM_OK);
        assert_true(fabs(dem_energy(&w).error) < 1e-15);
    }
    assert_true(w.passed_count >= 1 && fabs(dem_energy(&w).link_work) > 1e-9);
    dem_free(&w);
}

/* ---- the end of a contact ---- */

DEM_INLINE void attracting_force(const dem_contact *c, double *state, dem_response *r) {
    dem_force_linear(c, state, r);
    r->normal -= 1e-3; /* also where the contact has ended */
}
static const dem_law attracting = {"attracting",     1,    0,   0, 0, DEM_LINEAR_CONSTANTS, dem_prepare_linear,
                                   attracting_force, NULL, NULL};
DEM_KERNEL(attracting_kernel, attracting, DEM_LINEAR)

/* Whatever a law answers for a contact that is over: from the next step on its bodies fly. */
static void test_flight_after_an_attraction(void **state) {
    (void)state;
    const double at[6] = {0, 0, 0, 0, 0, 2.5e-3}, d[2] = {2e-3, 2e-3};
    dem_def def = scene_def(1e-6);
    dem_world w;
    dem_pair(&def, 0, 0)->stiffness = 1e3;
    def.gravity = dem_vec3(0, 0, 0);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 2, at, d, 0, 0), DEM_OK);
    assert_int_equal(dem_set_motion(&w, 1, dem_vec3(0, 0, -0.5), dem_vec3(0, 0, 0)), DEM_OK);
    for (int k = 0; k < 100 && !(dem_velocity(&w, 0).z < -0.2 && dem_contact_count(&w) == 0); k++)
        assert_int_equal(dem_run_law(&w, 5e-5, &attracting_kernel), DEM_OK);
    const dem_vec v = dem_velocity(&w, 0);
    assert_true(v.z < -0.2 && dem_contact_count(&w) == 0);
    assert_int_equal(dem_run_law(&w, 5e-3, &attracting_kernel), DEM_OK);
    assert_true(dem_velocity(&w, 0).z == v.z);
    dem_free(&w);
}

/* ---- numbers whose products overflow ---- */

static void test_refused_where_they_enter(void **state) {
    (void)state;
    const double at[3] = {0, 0, 0}, d = 1e-3, far_away[3] = {0, 1e200, 0};
    const dem_vec none = dem_vec3(0, 0, 0), up = dem_vec3(0, 0, 1), far_out = dem_vec3(0, 1e200, 0);
    dem_cone cone = dem_default_cone();
    dem_screen screen = dem_default_screen();
    dem_def def = scene_def(4e-6);
    dem_world w;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 1, at, &d, 0, 0), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 1, far_away, &d, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_load(&w, 0, far_out, none), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_load(&w, 0, none, dem_vec3(0, 0, 1e80)), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_motion(&w, 0, far_out, none), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_motion(&w, 0, none, far_out), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_gravity(&w, far_out), DEM_BAD_ARGUMENT);
    cone.high = screen.centre = far_out;
    assert_true(dem_add_plane(&w, 0, far_out, up) < 0 && dem_add_exit(&w, far_out, up) < 0);
    assert_true(dem_add_cylinder(&w, 0, far_out, up, 1.0, 1) < 0 && dem_add_sphere_wall(&w, 0, far_out, 1.0, 1) < 0);
    assert_true(dem_add_cone(&w, 0, &cone) < 0 && dem_add_screen(&w, 0, &screen) < 0);
    const int wall = dem_add_plane(&w, 0, dem_vec3(0, 0, -1), up);
    assert_int_equal(dem_vibrate(&w, wall, none, none, 1e308), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_move(&w, wall, far_out), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_rotate(&w, wall, far_out, up, 1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_rotate(&w, wall, none, up, 1e200), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_control_force(&w, wall, up, 1e-300, 1.0, 0.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_control_force(&w, wall, up, 1e-100, 0.0, 1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_control_torque(&w, wall, none, up, 1e-300, 1.0, 0.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_run(&w, 1e-4, DEM_LINEAR | DEM_ENERGY), DEM_OK);
    assert_true(fabs(dem_energy(&w).error) < 1e-15);
    dem_free(&w);
}

/* A list holds for its first step however thin its margin, and is checked before it ends: spheres that move up to half
   a radius in a step are seen where they touch, whatever the skin. */
static void test_fast_spheres_are_seen(void **state) {
    (void)state;
    static const double skins[] = {0.9, 0.35, 0.1, 0.05, 0.02, 0.01, 1e-3, 1e-6};
    const double d[3] = {2e-3, 2e-3, 2e-3};
    for (int distance = 0; distance < 40; distance++) {
        const double apart = 2.05e-3 + 5e-5 * distance, at[9] = {0, 0, 0, apart, 0, 0, 0, 0.5, 0};
        uint64_t expected = 0;
        for (size_t k = 0; k < sizeof skins / sizeof *skins; k++) {
            const double speed = (distance % 4 + 1) * 0.1e-3 / 4e-6;
            dem_def def = scene_def(4e-6);
            dem_world w;
            def.skin = skins[k];
            assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
            assert_int_equal(dem_add_spheres(&w, 3, at, d, 0, 0), DEM_OK);
            assert_int_equal(dem_set_motion(&w, 0, dem_vec3(speed, 0, 0), dem_vec3(0, 0, 0)), DEM_OK);
            assert_int_equal(dem_set_motion(&w, 1, dem_vec3(-speed, 0, 0), dem_vec3(0, 0, 0)), DEM_OK);
            assert_int_equal(dem_run(&w, 30 * 4e-6, DEM_LINEAR), DEM_OK);
            if (k == 0) expected = dem_hash(&w);
            else assert_true(dem_hash(&w) == expected);
            dem_free(&w);
        }
    }
}

/* A sphere that gets the place of a polyhedron that is gone is a sphere. */
static void test_place_of_a_polyhedron(void **state) {
    (void)state;
    const double at[6] = {0, 0, 0, 0.1, 0, 0}, d = 2e-3;
    dem_convex brick;
    dem_def def = scene_def(4e-6);
    dem_world w;
    assert_int_equal(dem_make_brick(&brick, dem_vec3(2e-3, 3e-3, 4e-3), 0.05, NULL), DEM_OK);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_add_shape(&w, &brick), 0);
    assert_int_equal(dem_add_convex(&w, 0, 2, at, NULL, 0, 0), DEM_OK);
    assert_int_equal(dem_remove(&w, 1), DEM_OK);
    assert_int_equal(dem_run(&w, 1e-4, DEM_LINEAR | DEM_FRICTION), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 1, at + 3, &d, 0, 0), DEM_OK);
    assert_true(w.count == 2 && dem_shape_of(&w, 0) == 0 && dem_shape_of(&w, 1) == -1);
    dem_free(&w);
}

/* A clump under a load, which takes steps in flight, goes on from a save with the same bits, whenever that was. */
static void test_loaded_clump_goes_on(void **state) {
    (void)state;
    const double centre[9] = {0, 0, 0, 1.5e-3, 1e-3, 0, 0, 1e-3, 2e-3}, d[3] = {2e-3, 1.5e-3, 2.5e-3},
                 at[3] = {0, 0, 0};
    dem_clump clump;
    dem_def def = scene_def(4e-6);
    dem_world w, twin;
    assert_int_equal(dem_make_clump(3, centre, d, &clump), DEM_OK);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_add_clumps(&w, 1, &clump, at, NULL, NULL, 0, 0), DEM_OK);
    assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0.1, 0, 0.2), dem_vec3(3, -50, 20)), DEM_OK);
    assert_int_equal(dem_set_load(&w, 1, dem_vec3(1e-4, 2e-4, 1e-3), dem_vec3(1e-7, 0, -1e-7)), DEM_OK);
    for (int k = 0; k < 20; k++) {
        const size_t size = dem_save(&w, NULL, 0);
        void *bytes = malloc(size);
        assert_non_null(bytes);
        assert_true(dem_save(&w, bytes, size) == size);
        assert_int_equal(dem_load(&twin, bytes, size, NULL), DEM_OK);
        free(bytes);
        assert_int_equal(dem_run(&w, 1.7e-4, DEM_LINEAR), DEM_OK);
        assert_int_equal(dem_run(&twin, 1.7e-4, DEM_LINEAR), DEM_OK);
        assert_true(dem_hash(&w) == dem_hash(&twin));
        dem_free(&twin);
    }
    dem_free(&w);
}

/* Time steps whose square is no normal number are refused, at first and later. */
static void test_time_steps(void **state) {
    (void)state;
    static const double bad[] = {0.0, -1e-6, 1e-300, 5e-324, 1e-61, 1e6, 1e300, (double)INFINITY, (double)NAN};
    dem_def def = scene_def(4e-6);
    dem_world w;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        dem_world other;
        const char *field = NULL;
        assert_int_equal(dem_set_time_step(&w, bad[k]), DEM_BAD_ARGUMENT);
        def.dt = bad[k];
        assert_int_equal(dem_init(&other, &def, &field), DEM_BAD_DEFINITION);
        assert_string_equal(field, "dt");
    }
    dem_free(&w);
}

/* ---- memory that runs out in a rich scene ---- */

DEM_INLINE dem_vec weak_pull(const dem_force_point *at) { return dem__scale(-at->mass, at->position); }
DEM_FORCE_FIELD(weak_field, weak_pull)

enum { RICH_SPHERES, RICH_BODIES, RICH_FIELD, RICH_SOURCES, RICH_SCENES };
static const double rich_run = 1.2e-3; /* [s] */

static dem_status from_wall(int wall) { return wall >= 0 ? DEM_OK : (dem_status)-wall; }
static dem_status rich_wall(dem_world *w, int k) {
    const dem_vec up = dem_vec3(0, 0, 1), none = dem_vec3(0, 0, 0);
    double vertex[12] = {-0.02, -0.02, -5e-3, 0.02, -0.02, -5e-3, 0.0, 0.02, -5e-3, 0.0, 0.0, -0.02};
    int32_t triangle[12] = {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0};
    dem_screen screen = dem_default_screen();
    dem_cone cone = dem_default_cone();
    dem_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.vertices = 4, mesh.triangles = 4, mesh.vertex = vertex, mesh.triangle = triangle;
    cone.low = dem_vec3(0, 0, -1e-3), cone.high = dem_vec3(0, 0, 0.03), cone.low_radius = 0.012,
    cone.high_radius = 0.02;
    screen.half_x = 0.03, screen.aperture = 3e-3, screen.wire = 1e-3, screen.centre = dem_vec3(0, 0, -2e-3);
    switch (k) {
    case 0: return from_wall(dem_add_plane(w, 1, dem_vec3(0, 0, -6e-3), up));
    case 1: return from_wall(dem_add_cylinder(w, 1, none, up, 0.025, 1));
    case 2: return from_wall(dem_add_sphere_wall(w, 1, dem_vec3(0, 0, -0.012), 0.01, 0));
    case 3: return from_wall(dem_add_cone(w, 1, &cone));
    case 4: return from_wall(dem_add_screen(w, 1, &screen));
    case 5: return from_wall(dem_add_mesh(w, 1, &mesh));
    case 6: return from_wall(dem_add_box(w, 1, dem_vec3(-0.03, -0.03, -0.03), dem_vec3(0.03, 0.03, 0.05)));
    case 7: return from_wall(dem_add_exit(w, dem_vec3(0, 0, -4e-3), up));
    default: return dem_set_solid(w, 5, 1);
    }
}
static dem_status rich_bodies(dem_world *w) {
    const double centre[6] = {0, 0, 0, 1.5e-3, 0, 0}, d[2] = {2e-3, 2e-3}, at[6] = {2e-3, 0, 0.014, -3e-3, 1e-3, 0.012};
    dem_clump clump;
    const dem_status made = dem_make_clump(2, centre, d, &clump);
    return made != DEM_OK ? made : dem_add_clumps(w, 2, &clump, at, NULL, NULL, 0, 1);
}
static dem_status rich_bricks(dem_world *w, int n) {
    const double at[6] = {0, 3e-3, 5e-3, 0, -3e-3, 5e-3};
    dem_convex brick;
    if (n > 0) return dem_add_convex(w, 0, n, at, NULL, 0, 2);
    const dem_status made = dem_make_brick(&brick, dem_vec3(2e-3, 3e-3, 2e-3), 0.05, NULL);
    return made != DEM_OK ? made : from_wall(dem_add_shape(w, &brick));
}

/* Action k of a scene; *over: it was the last. */
static dem_status rich_action(dem_world *w, dem_feed *feed, int scene, int k, double run_for, int *over) {
    const int features = DEM_LINEAR | DEM_FRICTION | (scene == RICH_FIELD ? 0 : DEM_ENERGY);
    const double weak[SPRING_STATES] = {0.05, 1e-2, 0.0};
    const dem_region low = dem_box_region(dem_vec3(-1, -1, -1), dem_vec3(1, 1, -1.5e-3));
    const dem_force_field field = dem_default_force_field(weak_field, NULL);
    dem_measure measure;
    *over = k == 20;
    if (k < 9) return rich_wall(w, k);
    switch (k) {
    case 9: return dem_fill(w, feed, scene == RICH_SOURCES ? 8 : 40);
    case 10: return scene == RICH_BODIES ? rich_bodies(w) : DEM_OK;
    case 11: return scene == RICH_BODIES ? rich_bricks(w, 0) : DEM_OK;
    case 12: return scene == RICH_BODIES ? rich_bricks(w, 2) : DEM_OK;
    case 13: return scene == RICH_SPHERES ? dem_set_links(w, &spring_kernel, 2e-5, 0.0) : DEM_OK;
    case 14: return scene == RICH_SPHERES ? dem_add_link(w, 0, 1, 0, weak) : DEM_OK;
    case 15: return scene == RICH_FIELD ? dem_set_force_field(w, &field) : DEM_OK;
    case 16:
    case 19: return dem_run(w, run_for, features);
    case 17: return dem_feed_number(w, feed, 2e4, rich_run);
    case 18: return dem_measure_region(w, &low, &measure);
    default: return dem_remove_region(w, &low) >= 0 && dem_take_passed(w, NULL, 1000) >= 0 ? DEM_OK : DEM_OUT_OF_MEMORY;
    }
}

/* What can be done with a world that has no memory: it is read, saved, and loaded elsewhere. */
static void can_be_saved(const dem_world *w) {
    const size_t size = dem_save(w, NULL, 0);
    unsigned char *bytes = (unsigned char *)malloc(size);
    dem_world twin;
    assert_non_null(bytes);
    assert_true(dem_save(w, bytes, size) == size);
    assert_int_equal(dem_load(&twin, bytes, size, NULL), DEM_OK);
    assert_true(dem_hash(&twin) == dem_hash(w));
    dem_free(&twin);
    free(bytes);
}

/* Sources of clumps within a mesh. */
static void feed_clumps(dem_feed *feed) {
    static double vertex[12] = {-0.02, -0.02, 2e-3, 0.02, -0.02, 2e-3, 0.0, 0.02, 2e-3, 0.0, 0.0, 0.03};
    static int32_t triangle[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
    static dem_mesh mesh;
    static dem_clump clump;
    const double centre[6] = {0, 0, 0, 1.5e-3, 0, 0}, d[2] = {2e-3, 2e-3};
    mesh.vertices = 4, mesh.triangles = 4, mesh.vertex = vertex, mesh.triangle = triangle;
    assert_int_equal(dem_make_clump(2, centre, d, &clump), DEM_OK);
    feed->region = dem_mesh_region(&mesh), feed->clump = &clump;
}

/* The scene with allocation fail_at failing, `times` in a row (negative: until it is mended); the hash of its end. */
static uint64_t rich_scene(int scene, failing_allocator *memory, int fail_at, int times) {
    dem_def def = scene_def(4e-6);
    dem_feed feed = dem_default_feed();
    dem_world w;
    failing_init(memory);
    memory->fail_at = fail_at, memory->fail_count = times;
    def.allocator.fn = failing_fn, def.allocator.user = memory;
    dem_pair(&def, 0, 0)->stiffness = dem_pair(&def, 0, 1)->stiffness = 500.0,
                      *dem_pair(&def, 1, 1) = *dem_pair(&def, 0, 0);
    feed.sizes = dem_uniform_sizes(1.5e-3, 3e-3, 1), feed.velocity = dem_vec3(0, 0, -0.5);
    feed.region = dem_box_region(dem_vec3(-9e-3, -9e-3, 2e-3), dem_vec3(9e-3, 9e-3, 0.02));
    if (scene == RICH_SOURCES) feed_clumps(&feed);
    if (dem_init(&w, &def, NULL) == DEM_OUT_OF_MEMORY) {
        assert_int_equal(failing_live(memory), 0);
        memory->fail_at = -1;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    }
    for (int k = 0, over = 0; !over; k++) {
        const double wanted = w.time + w.owed + rich_run;
        const dem_feed before = feed;
        for (int tries = 0;; tries++) {
            const uint64_t was = dem_hash(&w);
            const dem_status status = rich_action(&w, &feed, scene, k, tries ? wanted - w.time : rich_run, &over);
            if (status == DEM_OK) break;
            assert_true(status == DEM_OUT_OF_MEMORY && tries < 3);
            if (k != 16 && k != 19) assert_true(dem_hash(&w) == was);
            feed = before;
            can_be_saved(&w);
            if (tries == 1) memory->fail_at = -1;
        }
    }
    const uint64_t hash = dem_hash(&w);
    dem_free(&w);
    assert_int_equal(failing_live(memory), 0);
    return hash;
}

/* Every allocation of a scene with all that there is fails, once and until it is mended: afterwards everything is as
   if it had not. */
static void test_memory_of_rich_scenes(void **state) {
    (void)state;
    for (int scene = 0; scene < RICH_SCENES; scene++) {
        failing_allocator memory;
        const uint64_t expected = rich_scene(scene, &memory, -1, 0);
        const int allocations = memory.calls;
        print_message("    scene %d: %d allocations\n", scene, allocations);
        assert_true(allocations > 15);
        for (int k = 0; k < allocations; k++) {
            for (int times = 1; times >= -1; times -= 2) {
                const uint64_t hash = rich_scene(scene, &memory, k, times);
                if (hash != expected || !memory.has_failed)
                    fail_msg("scene %d, allocation %d: %d", scene, k, memory.has_failed);
            }
        }
        print_message("    scene %d: %d allocations\n", scene, allocations);
    }
}

/* Rigid bodies come and go in a field, which is set before or after them, also after a save. */
static void test_field_after_bodies(void **state) {
    (void)state;
    const double centre[6] = {0, 0, 0, 1.5e-3, 0, 0}, d[2] = {2e-3, 2e-3}, at[3] = {0, 0, 0}, apart[3] = {0, 0, 0.01};
    const dem_force_field field = dem_default_force_field(weak_field, NULL);
    dem_clump clump;
    dem_def def = scene_def(4e-6);
    dem_world w, twin;
    assert_int_equal(dem_make_clump(2, centre, d, &clump), DEM_OK);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_add_clumps(&w, 1, &clump, at, NULL, NULL, 0, 0), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 1, apart, d, 0, 0), DEM_OK);
    assert_int_equal(dem_set_force_field(&w, &field), DEM_OK);
    assert_int_equal(dem_run(&w, 1e-4, DEM_LINEAR), DEM_OK);
    assert_int_equal(dem_remove(&w, 0), DEM_OK);
    assert_int_equal(dem_run(&w, 1e-4, DEM_LINEAR), DEM_OK);
    assert_int_equal(dem_add_clumps(&w, 1, &clump, at, NULL, NULL, 0, 0), DEM_OK);
    const size_t size = dem_save(&w, NULL, 0);
    void *bytes = malloc(size);
    assert_non_null(bytes);
    assert_true(dem_save(&w, bytes, size) == size);
    assert_int_equal(dem_load(&twin, bytes, size, NULL), DEM_OK);
    free(bytes);
    assert_int_equal(dem_set_force_field(&twin, &field), DEM_OK); /* the one that it had */
    dem_world *const both[] = {&w, &twin};
    for (int k = 0; k < 2; k++) {
        assert_int_equal(dem_run(both[k], 1e-4, DEM_LINEAR), DEM_OK);
        assert_int_equal(dem_remove(both[k], both[k]->count - 1), DEM_OK);
        assert_int_equal(dem_run(both[k], 1e-4, DEM_LINEAR), DEM_OK);
    }
    assert_true(dem_hash(&w) == dem_hash(&twin));
    dem_free(&w), dem_free(&twin);
}

/* A body that turns by more than a hundred radians a step is too fast, whatever its moments; a spin of some radians a
   step is followed. */
static void test_spin_without_end(void **state) {
    (void)state;
    enum { SPINS = 3, SHAPES = 3 };
    static const double spin[SPINS] = {1e80, 1e12, 1e6},
                        side[SHAPES][3] = {{2e-3, 3e-3, 4e-3}, {2e-3, 2e-3, 4e-3}, {2e-3, 2e-3, 2e-3}};
    const double at[3] = {0, 0, 0};
    for (int k = 0; k < SPINS * SHAPES; k++) {
        const double s = spin[k % SPINS], *sides = side[k / SPINS];
        dem_def def = scene_def(1e-6);
        dem_world w;
        dem_convex brick;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        assert_int_equal(dem_make_brick(&brick, dem_vec3(sides[0], sides[1], sides[2]), 0.05, NULL), DEM_OK);
        const int shape = dem_add_shape(&w, &brick);
        assert_true(shape >= 0);
        assert_int_equal(dem_add_convex(&w, shape, 1, at, NULL, 0, 0), DEM_OK);
        assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0, 0, 0), dem_vec3(s, 0.5 * s, s)), DEM_OK);
        assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY),
                         k % SPINS < 2 ? DEM_TOO_FAST : DEM_OK);
        assert_true(dem_position(&w, 0).z <= 0.0);
        if (k % SPINS == 2) assert_true(dem_energy(&w).rotational <= DBL_MAX);
        dem_free(&w);
    }
}

DEM_INLINE void exploding_force(const dem_contact *c, double *state, dem_response *r) {
    dem_force_linear(c, state, r); /* fills the whole answer */
    r->normal = c->gap < -1e-4 ? 1e200 : 0.0;
}
static const dem_law exploding = {"exploding",     1,    0,   0, 0, DEM_LINEAR_CONSTANTS, dem_prepare_linear,
                                  exploding_force, NULL, NULL};
DEM_KERNEL(exploding_kernel, exploding, DEM_LINEAR)

/* A sphere that leaves in the very step in which its energy overflows is a failure, as one that stays is. */
static void test_infinite_energy_does_not_leave(void **state) {
    (void)state;
    const double at[3] = {0, 0, 1.0735e-3}, d = 2e-3, exit_at = 1e-3 - 1e-4;
    dem_def def = scene_def(4e-6);
    dem_world w;
    def.gravity = dem_vec3(0, 0, 0);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 1, at, &d, 0, 0), DEM_OK);
    assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0, 0, -0.3), dem_vec3(0, 0, 0)), DEM_OK);
    assert_true(dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) >= 0);
    assert_true(dem_add_exit(&w, dem_vec3(0, 0, exit_at), dem_vec3(0, 0, 1)) >= 0);
    /* Begins the ledger; the sphere is still in flight. */
    assert_int_equal(dem_run(&w, 2.4e-4, DEM_LINEAR | DEM_ENERGY), DEM_OK);
    assert_int_equal(dem_run_law(&w, 1e-3, &exploding_kernel), DEM_NOT_FINITE);
    assert_true(w.passed_total == 1);
    dem_free(&w);
}

/* A shape that is none is refused where it enters, not met in a run. */
static void test_shapes_that_are_none(void **state) {
    (void)state;
    dem_def def = scene_def(4e-6);
    dem_convex good, bad;
    dem_world w;
    assert_int_equal(dem_make_brick(&good, dem_vec3(2e-3, 3e-3, 4e-3), 0.05, NULL), DEM_OK);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
#define REFUSED(change) (bad = good, change, assert_int_equal(dem_add_shape(&w, &bad), -(int)DEM_BAD_ARGUMENT))
    REFUSED(bad.corners = 33), REFUSED(bad.corners = -1), REFUSED(bad.edges = INT_MAX), REFUSED(bad.faces = 1000),
        REFUSED(bad.faces = 0);
    REFUSED(bad.face_corner[3] = 200), REFUSED(bad.edge[2][1] = 32), REFUSED(bad.edge_face[0][0] = 60),
        REFUSED(bad.face_start[1] = 0);
    REFUSED(bad.radius = (double)NAN), REFUSED(bad.reach = (double)INFINITY), REFUSED(bad.volume = 0.0),
        REFUSED(bad.rate = 0.0), REFUSED(bad.springs = 0);
    REFUSED(bad.moment[1] = -1.0), REFUSED(bad.corner[5][2] = 1e9), REFUSED(bad.plane[4][0] = (double)NAN);
#undef REFUSED
    assert_int_equal(dem_add_shape(&w, &good), 0);
    dem_free(&w);
}

/* A sphere, and a clump, that were fixed or loaded and are free again fly as if they had always been: what is saved
   then goes on with the same bits. */
static void test_free_again_flies(void **state) {
    (void)state;
    const double at[3] = {0, 0, 0}, far_off[3] = {1e-2, 0, 0}, d = 2e-3, centre[6] = {0, 0, 0, 1.5e-3, 0, 0},
                 of[2] = {2e-3, 2e-3};
    const dem_vec none = dem_vec3(0, 0, 0);
    dem_clump clump;
    assert_int_equal(dem_make_clump(2, centre, of, &clump), DEM_OK);
    for (int way = 0; way < 2; way++) {
        dem_def def = scene_def(3e-6);
        dem_world w, twin;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        assert_int_equal(dem_add_spheres(&w, 1, at, &d, 0, 0), DEM_OK);
        assert_int_equal(dem_add_clumps(&w, 1, &clump, far_off, NULL, NULL, 0, 0), DEM_OK);
        for (int i = 0; i < 2; i++) {
            assert_int_equal(way ? dem_set_load(&w, i, dem_vec3(1e-4, 0, 0), none) : dem_fix(&w, i, 1), DEM_OK);
            assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR), DEM_OK);
            assert_int_equal(way ? dem_set_load(&w, i, none, none) : dem_fix(&w, i, 0), DEM_OK);
        }
        const size_t size = dem_save(&w, NULL, 0);
        void *bytes = malloc(size);
        assert_non_null(bytes);
        assert_true(dem_save(&w, bytes, size) == size);
        assert_int_equal(dem_load(&twin, bytes, size, NULL), DEM_OK);
        free(bytes);
        assert_int_equal(dem_run(&w, 7e-3, DEM_LINEAR), DEM_OK);
        assert_int_equal(dem_run(&twin, 7e-3, DEM_LINEAR), DEM_OK);
        assert_true(dem_hash(&w) == dem_hash(&twin));
        dem_free(&w), dem_free(&twin);
    }
}

/* ---- what a host sets afterwards, and what its law leaves out ---- */

/* Numbers of threads that are none: the run is refused and changes nothing, and what is saved then can be loaded. */
static void test_threads_set_later(void **state) {
    (void)state;
    static const int bad[] = {0, -1, INT_MIN, INT_MAX, 4097};
    const double at[3] = {0, 0, 0}, d = 1e-3;
    dem_def def = scene_def(4e-6);
    dem_world w;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 1, at, &d, 0, 0), DEM_OK);
    assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR), DEM_OK);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        dem_world twin;
        const uint64_t was = dem_hash(&w);
        w.def.threads = bad[k];
        assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR), DEM_BAD_DEFINITION);
        assert_true(dem_hash(&w) == was && w.status == DEM_OK && dem_energy(&w).kinetic > 0.0);
        const size_t size = dem_save(&w, NULL, 0);
        void *bytes = malloc(size);
        assert_non_null(bytes);
        assert_true(dem_save(&w, bytes, size) == size);
        assert_int_equal(dem_load(&twin, bytes, size, NULL), DEM_OK);
        free(bytes);
        assert_int_equal(twin.def.threads, 1);
        w.def.threads = 2;
        assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR), DEM_OK);
        assert_int_equal(dem_run(&twin, 1e-3, DEM_LINEAR), DEM_OK);
        assert_true(dem_hash(&w) == dem_hash(&twin));
        dem_free(&twin);
    }
    dem_free(&w);
}

/* Memory that is no world, whatever it contains, becomes one. */
static void test_worlds_in_used_memory(void **state) {
    (void)state;
    dem_def def = scene_def(4e-6);
    dem_world w, copy;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    const size_t size = dem_save(&w, NULL, 0);
    void *bytes = malloc(size);
    assert_non_null(bytes);
    assert_true(dem_save(&w, bytes, size) == size);
    copy = w; /* looks like a world in use */
    dem_free(&w);
    assert_int_equal(dem_init(&copy, &def, NULL), DEM_OK);
    dem_free(&copy);
    memset(&copy, 0xa5, sizeof copy);
    assert_int_equal(dem_load(&copy, bytes, size, NULL), DEM_OK);
    dem_free(&copy);
    memset(&copy, 0xa5, sizeof copy);
    assert_int_equal(dem_load(&copy, bytes, size - 1, NULL), DEM_BAD_DATA); /* and is empty after a failure */
    dem_free(&copy);
    free(bytes);
}

DEM_INLINE void terse_force(const dem_contact *c, double *state, dem_response *r) {
    (void)state;
    if (c->gap < 0.0) r->normal = r->contact = -1e3 * c->gap;
    else r->ended = 1.0;
}
static double no_constants(const dem_birth *birth, double *constants) { return (void)birth, (void)constants, 0.0; }
static const dem_law terse = {"terse", 1, 0, 0, 0, 0, no_constants, terse_force, NULL, NULL};
DEM_KERNEL(terse_kernel, terse, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY)
DEM_INLINE void terse_pull(const dem_contact *c, double *state, dem_response *r) {
    (void)state;
    r->normal = -1e-3 * c->gap;
}
static const dem_law terse_link = {"terse link", 1, 0, 0, 0, 0, NULL, terse_pull, NULL, NULL};
DEM_LINK_KERNEL(terse_link_kernel, terse_link)

/* A law that sets two numbers of its response: the rest is 0, in the first and last step of a contact, too,
   and of a link. */
static void test_terse_law(void **state) {
    (void)state;
    const double at[9] = {0, 0, 0, 0.3e-3, 0.2e-3, 2.2e-3, 5e-3, 0, 0}, d[3] = {2e-3, 2e-3, 2e-3};
    uint64_t first = 0;
    for (int k = 0; k < 3; k++) {
        dem_def def = scene_def(1e-6);
        dem_world w;
        def.gravity = dem_vec3(0, 0, 0);
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        assert_int_equal(dem_add_spheres(&w, 3, at, d, 0, 0), DEM_OK);
        assert_int_equal(dem_set_links(&w, &terse_link_kernel, 1e-5, 0.0), DEM_OK);
        assert_int_equal(dem_add_link(&w, 0, 2, 0, NULL), DEM_OK);
        assert_int_equal(dem_set_motion(&w, 1, dem_vec3(0, 0, -0.5), dem_vec3(30, 20, -10)), DEM_OK);
        assert_int_equal(dem_run_law(&w, 3e-3, &terse_kernel), DEM_OK);
        const dem_vec v = dem_velocity(&w, 0), spin = dem_spin(&w, 1);
        const dem_energy_ledger e = dem_energy(&w);
        assert_true(v.z < -0.1 && dem_contact_count(&w) == 0 && spin.x == 30.0 && spin.y == 20.0 && spin.z == -10.0);
        assert_true(e.sliding_loss == 0.0 && e.rolling_loss == 0.0 &&
                    fabs(e.kinetic - dem_mass(&w, 0) * 0.125) < 1e-3 * e.kinetic);
        if (k == 0) first = dem_hash(&w);
        assert_true(dem_hash(&w) == first);
        dem_free(&w);
    }
}

/* ---- what a caller can mend is asked again ---- */

/* Links that reach too far for the lists are refused by every run until dem_set_links mends it; then the world goes on
   as one that never asked for it. */
static void test_links_too_near_are_mended(void **state) {
    (void)state;
    const double at[9] = {0, 0, 0, 0, 1e-3, 2.1e-3, 5e-3, 0, 0}, d[3] = {2e-3, 2e-3, 2e-3},
                 weak[SPRING_STATES] = {0.05, 1.0, 0.0};
    uint64_t expected = 0;
    for (int asks = 0; asks < 2; asks++) {
        dem_def def = scene_def(4e-6);
        dem_world w;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        assert_int_equal(dem_add_spheres(&w, 3, at, d, 0, 0), DEM_OK);
        assert_int_equal(dem_set_motion(&w, 1, dem_vec3(0, 0, -0.3), dem_vec3(0, 0, 0)), DEM_OK);
        assert_int_equal(dem_set_links(&w, &spring_kernel, 2e-5, 1e-7), DEM_OK);
        assert_int_equal(dem_add_link(&w, 0, 1, 0, weak), DEM_OK);
        assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR | DEM_ENERGY), DEM_OK);
        if (asks) {
            const uint64_t was = dem_hash(&w);
            assert_int_equal(dem_set_links(&w, &spring_kernel, 2e-5, 1e-3), DEM_OK);
            for (int k = 0; k < 3; k++)
                assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR | DEM_ENERGY), DEM_BAD_DEFINITION);
            assert_true(dem_hash(&w) == was && w.owed == 0.0);
            assert_int_equal(dem_set_links(&w, &spring_kernel, 2e-5, 1e-7), DEM_OK);
        }
        assert_int_equal(dem_run(&w, 5e-3, DEM_LINEAR | DEM_ENERGY), DEM_OK);
        assert_true(dem_link_count(&w) == 1 && fabs(dem_energy(&w).error) < 1e-9);
        if (asks) assert_true(dem_hash(&w) == expected);
        else expected = dem_hash(&w);
        dem_free(&w);
    }
}

/* However late the clock, a run of one step makes one step, and the motion has the same bits. */
static void test_late_clock(void **state) {
    (void)state;
    static const double late[] = {0.0, 1e9, 1e12, 4e15};
    const double at[3] = {0, 0, 1.5e-3}, d = 2e-3;
    dem_vec x = dem_vec3(0, 0, 0), v = x;
    for (int k = 0; k < 4; k++) {
        dem_def def = scene_def(5e5);
        dem_world w;
        def.gravity = dem_vec3(0, 0, 0);
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        assert_int_equal(dem_run(&w, late[k] < 1e10 ? late[k] : 1e10, DEM_LINEAR), DEM_OK);
        if (late[k] > 1e10)
            /* Nobody waits so long. */
            w.time = late[k], w.engine->run.start_time = late[k], w.engine->run.start_step = w.step;
        assert_true(w.time >= 0.999 * late[k]);
        assert_int_equal(dem_set_time_step(&w, 4e-6), DEM_OK);
        assert_int_equal(dem_set_gravity(&w, dem_vec3(0, 0, -9.81)), DEM_OK);
        assert_true(dem_add_plane(&w, 1, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) >= 0);
        assert_int_equal(dem_add_spheres(&w, 1, at, &d, 0, 0), DEM_OK);
        const int64_t before = w.step;
        for (int n = 1; n <= 5000; n++) {
            assert_int_equal(dem_run(&w, 4e-6, DEM_LINEAR | DEM_FRICTION), DEM_OK);
            assert_true(w.step == before + n);
        }
        if (k == 0) x = dem_position(&w, 0), v = dem_velocity(&w, 0);
        assert_true(v.z > 0.0 && dem_position(&w, 0).z == x.z && dem_velocity(&w, 0).z == v.z);
        dem_free(&w);
    }
}

/* ---- functions of the caller find a world that cannot be changed ---- */

static int accepted, hook_calls, may_add_links; /* by the hooks below */
static void try_to_change(dem_world *w) {
    const double weak[SPRING_STATES] = {0.05, 1.0, 0.0};
    const int k = dem_first_accepted(w, dem__kernel_linear(), &spring_kernel);
    if (k >= 0) print_message("    call %d was not refused\n", k), accepted++;
    if (dem_save(w, NULL, 0) != 0) print_message("    a step half done was saved\n"), accepted++;
    if (!may_add_links && dem_add_link(w, 0, 1, 0, weak) == DEM_OK) print_message("    a link was added\n"), accepted++;
    hook_calls++;
}
static void busy_born(dem_world *w, const int32_t *slots, ptrdiff_t n, void *user) {
    (void)slots, (void)n, (void)user;
    may_add_links = 1, try_to_change(w), may_add_links = 0;
}
static void busy_ended(dem_world *w, int32_t slot, void *user) {
    (void)slot, (void)user;
    try_to_change(w);
}
static const dem_law busy = {"busy",           1,         0,         0, 0, DEM_LINEAR_CONSTANTS, dem_prepare_linear,
                             dem_force_linear, busy_born, busy_ended};
DEM_KERNEL(busy_kernel, busy, DEM_LINEAR)
static const dem_law busy_spring = {"busy spring",      1,    SPRING_STATES, 0, 0, 0, NULL,
                                    scene_spring_force, NULL, busy_ended};
DEM_LINK_KERNEL(busy_link_kernel, busy_spring)
static void busy_motion(void *user, double time, dem_pose *pose) {
    pose->shift.z = 1e-3 * time;
    if (user) try_to_change((dem_world *)user);
}
DEM_INLINE dem_vec busy_law(const dem_force_point *at) {
    try_to_change((dem_world *)(uintptr_t)at->user);
    return dem__scale(-at->mass, at->position);
}
DEM_FORCE_FIELD(busy_field, busy_law)
static void busy_threads(void *user, int tasks, void (*task)(void *context, int index), void *context) {
    try_to_change((dem_world *)user);
    for (int k = 0; k < tasks; k++) task(context, k);
}
static int busy_stop(void *user) {
    try_to_change((dem_world *)user);
    return 0;
}
#define HOOKS_WERE_REFUSED(least) (assert_true(accepted == 0 && hook_calls >= (least)), hook_calls = 0)

static void test_hooks_change_nothing(void **state) {
    (void)state;
    const double at[12] = {0, 0, 0, 0, 0, 1.999e-3, 0, 0, 6e-3, 0, 0, 9e-3}, d[4] = {2e-3, 2e-3, 2e-3, 2e-3};
    const double weak[SPRING_STATES] = {0.05, 1.0, 0.0}, torn[SPRING_STATES] = {0.05, 1e-9, 0.0};
    const dem_vec none = dem_vec3(0, 0, 0), up = dem_vec3(0, 0, 1);
    const dem_region low = dem_box_region(dem_vec3(-1, -1, -1), dem_vec3(1, 1, 1e-3));
    dem_def def = scene_def(4e-6);
    dem_world w;
    accepted = hook_calls = 0;
    def.gravity = none, dem_pair(&def, 0, 0)->stiffness = 100.0;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 4, at, d, 0, 0), DEM_OK);
    assert_int_equal(dem_set_links(&w, &busy_link_kernel, 2e-5, 0.0), DEM_OK);
    for (int k = 1; k < 4; k++) assert_int_equal(dem_add_link(&w, 0, k, 0, weak), DEM_OK);
    assert_int_equal(dem_add_link(&w, 2, 3, 0, torn), DEM_OK);
    assert_int_equal(dem_run_law(&w, 4e-5, &busy_kernel), DEM_OK); /* a contact is born, a link tears */
    HOOKS_WERE_REFUSED(2);
    assert_true(dem_contact_count(&w) == 1 && dem_link_count(&w) == 3);
    assert_int_equal(dem_remove(&w, 3), DEM_OK); /* ends a link, outside a run */
    HOOKS_WERE_REFUSED(1);
    assert_true(dem_remove_region(&w, &low) == 1); /* ends a contact and two links */
    HOOKS_WERE_REFUSED(3);
    assert_true(dem_contact_count(&w) == 0 && dem_link_count(&w) == 0 && dem_remove(&w, 1) == DEM_OK);
    const int wall = dem_add_plane(&w, 0, dem_vec3(0, 0, -1), up);
    assert_int_equal(dem_prescribe(&w, wall, none, busy_motion, &w), DEM_OK);
    HOOKS_WERE_REFUSED(1);
    assert_int_equal(dem_run(&w, 2e-5, DEM_LINEAR), DEM_OK);
    HOOKS_WERE_REFUSED(5);
    /* Takes over from where the function has moved it. */
    assert_int_equal(dem_vibrate(&w, wall, none, none, 1.0), DEM_OK);
    HOOKS_WERE_REFUSED(1);
    assert_int_equal(dem_prescribe(&w, wall, none, busy_motion, &w), DEM_OK);
    assert_int_equal(dem_control_force(&w, wall, up, 1.0, 0.0, 0.0), DEM_OK);
    HOOKS_WERE_REFUSED(2);
    dem_free(&w);

    const dem_force_field field = dem_default_force_field(busy_field, &w);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 2, at, d, 0, 0), DEM_OK);
    assert_int_equal(dem_set_force_field(&w, &field), DEM_OK);
    assert_int_equal(dem_run(&w, 4e-5, DEM_LINEAR | DEM_ENERGY), DEM_OK);
    HOOKS_WERE_REFUSED(2);
    dem_free(&w);

    scene_random r = {1};
    def.parallel = busy_threads, def.parallel_user = &w, def.threads = 2;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(scene_fill(&w, &r, 10, 10, 10, none, 1.9e-3, d, 1, 0.1), DEM_OK);
    assert_int_equal(dem_run(&w, 2e-5, DEM_LINEAR | DEM_FRICTION), DEM_OK);
    HOOKS_WERE_REFUSED(1);
    dem_feed feed = dem_default_feed();
    w.def.parallel = NULL, w.def.stop = busy_stop, w.def.stop_user = &w;
    feed.region = dem_box_region(dem_vec3(0.1, 0.1, 0.1), dem_vec3(0.2, 0.2, 0.2));
    assert_int_equal(dem_fill(&w, &feed, 2000), DEM_OK);
    HOOKS_WERE_REFUSED(1);
    dem_free(&w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_memory_of_rich_scenes),
        cmocka_unit_test(test_field_after_bodies),
        cmocka_unit_test(test_spin_without_end),
        cmocka_unit_test(test_infinite_energy_does_not_leave),
        cmocka_unit_test(test_fast_spheres_are_seen),
        cmocka_unit_test(test_place_of_a_polyhedron),
        cmocka_unit_test(test_loaded_clump_goes_on),
        cmocka_unit_test(test_time_steps),
        cmocka_unit_test(test_laws_in_turn),
        cmocka_unit_test(test_lost_status),
        cmocka_unit_test(test_link_work_after_exit),
        cmocka_unit_test(test_flight_after_an_attraction),
        cmocka_unit_test(test_refused_where_they_enter),
        cmocka_unit_test(test_shapes_that_are_none),
        cmocka_unit_test(test_free_again_flies),
        cmocka_unit_test(test_threads_set_later),
        cmocka_unit_test(test_worlds_in_used_memory),
        cmocka_unit_test(test_terse_law),
        cmocka_unit_test(test_links_too_near_are_mended),
        cmocka_unit_test(test_late_clock),
        cmocka_unit_test(test_hooks_change_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
