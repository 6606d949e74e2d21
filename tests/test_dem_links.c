/* test_dem_links.c: links of dem.h, forces between bodies that need not touch, evaluated in steps of their own. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dem.h"
#include "dem_scenes.h"
#include "failing_allocator.h"

static void spring_ended(dem_world *w, int32_t slot, void *user) {
    assert_true(dem_get_link(w, slot).i >= 0);
    if (user) (*(long *)user)++;
}

static const dem_law spring = {"spring", 1, SPRING_STATES, 0, 0, 0, NULL, scene_spring_force, NULL, spring_ended};
DEM_LINK_KERNEL(spring_kernel, spring)
static const dem_law other = {"other", 1, SPRING_STATES + 1, 0, 0, 0, NULL, scene_spring_force, NULL, NULL};
DEM_LINK_KERNEL(other_kernel, other)

static const double SIZE = 5e-3, NEAR = 2e-6;

static void make(dem_world *w, double dt, dem_vec gravity) {
    dem_def def = scene_def(dt);
    def.gravity = gravity;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
}

static void add(dem_world *w, double x, double y, double z) {
    const double at[3] = {x, y, z};
    assert_int_equal(dem_add_spheres(w, 1, at, &SIZE, 0, 0), DEM_OK);
}

/* Two spheres whose gap swings by 0.3 mm around 1 mm, where a constant load holds the spring: the largest error over
   the amplitude. */
static double oscillation_error(double interval, double *drift) {
    dem_world w;
    const double state[SPRING_STATES] = {0.5, 1.0, 0.0};
    make(&w, 1e-6, dem_vec3(0, 0, 0));
    add(&w, 0, 0, 0), add(&w, SIZE + 1e-3, 0, 0);
    assert_int_equal(dem_set_links(&w, &spring_kernel, interval, 0.0), DEM_OK);
    assert_int_equal(dem_add_link(&w, 0, 1, 0, state), DEM_OK);
    const double pull = state[STIFFNESS] * 1e-3, mass = dem_mass(&w, 0), omega = sqrt(2.0 * state[STIFFNESS] / mass),
                 v0 = 0.3e-3 * omega;
    /* at rest at a gap of 1 mm */
    assert_int_equal(dem_set_load(&w, 0, dem_vec3(-pull, 0, 0), dem_vec3(0, 0, 0)), DEM_OK);
    assert_int_equal(dem_set_load(&w, 1, dem_vec3(pull, 0, 0), dem_vec3(0, 0, 0)), DEM_OK);
    assert_int_equal(dem_run(&w, interval, DEM_LINEAR), DEM_OK); /* the first evaluation: load and spring cancel */
    assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 0)), DEM_OK);
    assert_int_equal(dem_set_motion(&w, 1, dem_vec3(v0, 0, 0), dem_vec3(0, 0, 0)), DEM_OK);
    const double gap0 = dem_position(&w, 1).x - dem_position(&w, 0).x - SIZE, start = w.time;
    double worst = 0.0;
    while (w.time - start < 3.0 * 2.0 * RIDDLE_PI / omega) {
        assert_int_equal(dem_run(&w, interval, DEM_LINEAR), DEM_OK);
        const double t = w.time - start, gap = dem_position(&w, 1).x - dem_position(&w, 0).x - SIZE;
        worst = fmax(worst, fabs(gap - (1e-3 + (gap0 - 1e-3) * cos(omega * t) + 0.3e-3 * sin(omega * t))));
    }
    const dem_vec p = dem_momentum(&w);
    *drift = fabs(p.x - mass * v0) / (mass * v0);
    dem_free(&w);
    return worst / 0.3e-3;
}

static void test_oscillation(void **state) {
    (void)state;
    double drift, fine = oscillation_error(5e-4, &drift);
    print_message("momentum: drift %.2e\n", drift);
    const double coarse = oscillation_error(1e-3, &drift);
    print_message("oscillation: error %.2e and %.2e of the amplitude with links every 0.5 and 1 ms\n", fine, coarse);
    assert_true(drift < 1e-11);
    assert_true(coarse < 0.02 && coarse / fine > 3.5 && coarse / fine < 4.5); /* second order */
}

static void test_angular_momentum(void **state) {
    (void)state;
    dem_world w;
    const double spring_state[SPRING_STATES] = {2.0, 1.0, 1e-5};
    make(&w, 1e-6, dem_vec3(0, 0, 0));
    add(&w, 0, 0, 0), add(&w, SIZE + 1e-3, 0, 0);
    assert_int_equal(dem_set_links(&w, &spring_kernel, 1e-4, 0.0), DEM_OK);
    assert_int_equal(dem_add_link(&w, 0, 1, 0, spring_state), DEM_OK);
    assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0.01, -0.2, 0.05), dem_vec3(3, 20, -10)), DEM_OK);
    assert_int_equal(dem_set_motion(&w, 1, dem_vec3(0, 0.2, -0.05), dem_vec3(-5, 7, 30)), DEM_OK);
    double before[3], after[3], energy[2], scale = 0.0;
    for (int k = 0; k < 2; k++) {
        double *l = k ? after : before;
        /* Whole intervals: in between, half of a kick is due. */
        if (k) assert_int_equal(dem_run(&w, 0.02, DEM_LINEAR), DEM_OK);
        l[0] = l[1] = l[2] = energy[k] = 0.0;
        for (int i = 0; i < 2; i++) {
            const dem_vec x = dem_position(&w, i), v = dem_velocity(&w, i);
            const double m = dem_mass(&w, i), inertia = 0.4 * m * dem_radius(&w, i) * dem_radius(&w, i);
            l[0] += m * (x.y * v.z - x.z * v.y) + inertia * dem_spin(&w, i).x;
            l[1] += m * (x.z * v.x - x.x * v.z) + inertia * dem_spin(&w, i).y;
            l[2] += m * (x.x * v.y - x.y * v.x) + inertia * dem_spin(&w, i).z;
            energy[k] += 0.5 * m * (v.x * v.x + v.y * v.y + v.z * v.z);
        }
    }
    for (int a = 0; a < 3; a++) scale = fmax(scale, fabs(before[a]));
    for (int a = 0; a < 3; a++) assert_true(fabs(after[a] - before[a]) < 1e-13 * scale);
    dem_free(&w);
}

static void test_ledger(void **state) {
    (void)state;
    dem_world w;
    const double spring_state[SPRING_STATES] = {2.0, 1.0, 0.0};
    make(&w, 1e-6, dem_vec3(0, 0, -9.81));
    add(&w, 0, 0, 0), add(&w, SIZE + 1e-3, 0, 0);
    assert_int_equal(dem_set_links(&w, &spring_kernel, 1e-4, 0.0), DEM_OK);
    assert_int_equal(dem_add_link(&w, 0, 1, 0, spring_state), DEM_OK);
    assert_int_equal(dem_set_motion(&w, 1, dem_vec3(0, 0.2, -0.05), dem_vec3(-5, 7, 30)), DEM_OK);
    assert_int_equal(dem_run(&w, 1e-4, DEM_LINEAR | DEM_ENERGY), DEM_OK);
    const double first = dem_get_link(&w, 0).gap, before = dem_energy(&w).link_work;
    assert_int_equal(dem_run(&w, 0.0103, DEM_LINEAR | DEM_ENERGY), DEM_OK);
    const double last = dem_get_link(&w, 0).gap;
    const dem_energy_ledger l = dem_energy(&w);
    assert_true(fabs(l.error) < 1e-12 * (l.kinetic + l.rotational));
    assert_true(fabs(last - first) > 0.1 * first); /* it works: what it did is what the spring holds more now */
    print_message("work of the link %.6e J, its spring %.6e J, error %.1e J\n", l.link_work - before,
                  spring_state[STIFFNESS] * 0.5 * (first * first - last * last), l.error);
    assert_true(fabs((l.link_work - before) / (spring_state[STIFFNESS] * 0.5 * (first * first - last * last)) - 1.0) <
                2e-3);
    assert_int_equal(dem_run(&w, 3.3e-5, DEM_LINEAR | DEM_ENERGY), DEM_OK); /* and between two evaluations */
    assert_true(fabs(dem_energy(&w).error) < 1e-12 * (l.kinetic + l.rotational));
    dem_free(&w);
}

static void test_hanging(void **state) {
    (void)state;
    dem_world w;
    long ended = 0;
    make(&w, 4e-6, dem_vec3(0, 0, -9.81));
    const int ceiling = dem_add_plane(&w, 1, dem_vec3(0, 0, 0), dem_vec3(0, 0, -1));
    add(&w, 0, 0, -0.5 * SIZE - 1e-4);
    const double weight = 9.81 * dem_mass(&w, 0), strong[SPRING_STATES] = {weight / 4e-4, 9e-4, 5e-3},
                 weak[SPRING_STATES] = {weight / 4e-3, 9e-4, 0.0};
    w.user = &ended;
    assert_int_equal(dem_set_links(&w, &spring_kernel, 1e-4, 0.0), DEM_OK);
    assert_int_equal(dem_add_link(&w, 0, -1 - ceiling, 0, strong), DEM_OK);
    assert_int_equal(dem_find_link(&w, 0, -1 - ceiling, 0), 0);
    assert_int_equal(dem_find_link(&w, 0, -1 - ceiling, 1), -1);
    assert_int_equal(dem_run(&w, 1.0, DEM_LINEAR), DEM_OK);
    assert_true(fabs(-dem_position(&w, 0).z - 0.5 * SIZE - 4e-4) < 1e-10);
    assert_true(fabs(dem_get_link(&w, 0).gap - 4e-4) < 1e-10 &&
                fabs(dem_get_link(&w, 0).force.z / weight - 1.0) < 1e-6);
    dem_free(&w);
    make(&w, 4e-6, dem_vec3(0, 0, -9.81));
    w.user = &ended;
    dem_add_plane(&w, 1, dem_vec3(0, 0, 0), dem_vec3(0, 0, -1));
    add(&w, 0, 0, -0.5 * SIZE - 1e-4);
    assert_int_equal(dem_set_links(&w, &spring_kernel, 1e-4, 0.0), DEM_OK);
    assert_int_equal(dem_add_link(&w, 0, -1, 0, weak), DEM_OK);
    assert_int_equal(dem_run(&w, 0.1, DEM_LINEAR), DEM_OK);
    assert_int_equal(dem_link_count(&w), 0); /* torn */
    assert_int_equal(ended, 1);
    const double v = dem_velocity(&w, 0).z;
    assert_int_equal(dem_run(&w, 0.1, DEM_LINEAR), DEM_OK); /* and nothing of it is left: a free fall */
    assert_true(fabs(dem_velocity(&w, 0).z - (v - 9.81 * 0.1)) < 1e-9);
    dem_free(&w);
}

/* ---- a crowd: whoever touches is linked ---- */

static void crowd_born(dem_world *w, const int32_t *slots, ptrdiff_t n, void *user) {
    (void)user;
    for (ptrdiff_t k = 0; k < n; k++) {
        const dem_contact_info c = dem_get_contact(w, slots[k]);
        const double state[SPRING_STATES] = {0.4, 4e-4, 1e-4};
        if (dem_find_link(w, c.i, c.j, c.element) < 0 && dem_add_link(w, c.i, c.j, c.element, state) != DEM_OK)
            w->status = DEM_OUT_OF_MEMORY;
    }
}

DEM_INLINE void crowd_force(const dem_contact *c, double *state, dem_response *r) {
    dem_force_linear_friction(c, state, r);
    r->ended = c->gap < 2e-6 ? 0.0 : 1.0; /* NEAR */
}

static const dem_law crowd = {
    "linear, in contact below near", 1, 3, 3, 1, 8, dem_prepare_linear, crowd_force, crowd_born, NULL};
DEM_KERNEL(crowd_kernel, crowd, DEM_LINEAR | DEM_FRICTION)
enum { CROWD_FEATURES = DEM_LINEAR | DEM_FRICTION };

static dem_status make_crowd(dem_world *w, int scene, int skip, int threads, const dem_allocator *allocator) {
    dem_status status = scene_make(w, scene, skip, threads, allocator);
    return status == DEM_OK ? dem_set_links(w, &spring_kernel, 5e-5, NEAR) : status;
}

static void test_skipping_and_threads(void **state) {
    (void)state;
    for (int scene = 0; scene < SCENE_COUNT; scene++) {
        uint64_t hash = 0;
        for (int k = 0; k < 7; k++) {
            static const int skip[] = {DEM_SKIP_ALL, 0,           DEM_SKIP_PAIRS, DEM_SKIP_SPACE, DEM_SKIP_ALL,
                                       DEM_SKIP_ALL, DEM_SKIP_ALL};
            static const int threads[] = {1, 1, 1, 1, 2, 5, 1};
            dem_world w;
            assert_int_equal(make_crowd(&w, scene, skip[k], threads[k], NULL), DEM_OK);
            if (k == 6) w.def.skin = 0.6;
            assert_int_equal(dem_run_law(&w, 0.5 * scene_duration(scene), &crowd_kernel), DEM_OK);
            if (k == 0) {
                hash = dem_hash(&w);
                if (scene != SCENE_GAS) assert_true(dem_link_count(&w) > 0);
            }
            if (dem_hash(&w) != hash) fail_msg("scene %s, variant %d: other bits", scene_name(scene), k);
            dem_free(&w);
        }
    }
}

static void test_saving(void **state) {
    (void)state;
    dem_world w, copy;
    assert_int_equal(make_crowd(&w, SCENE_SCREEN, DEM_SKIP_ALL, 1, NULL), DEM_OK);
    assert_int_equal(dem_run_law(&w, 0.03 + 1.2e-5, &crowd_kernel), DEM_OK); /* not at a step of the links */
    assert_true(dem_link_count(&w) > 10);
    const size_t size = dem_save(&w, NULL, 0);
    unsigned char *bytes = malloc(size), *again = malloc(size);
    assert_int_equal(dem_save(&w, bytes, size), size);
    assert_int_equal(dem_load(&copy, bytes, size, NULL), DEM_OK);
    assert_int_equal(dem_save(&copy, again, size), size);
    assert_memory_equal(bytes, again, size);
    /* before anybody has said whose links these are */
    const dem_energy_ledger of = dem_energy(&w), loaded = dem_energy(&copy);
    assert_true(of.kinetic == loaded.kinetic && of.link_work == loaded.link_work);
    assert_int_equal(dem_run_law(&copy, 1e-3, &crowd_kernel), DEM_LAW_MISMATCH); /* whose links are these? */
    assert_int_equal(dem_set_links(&copy, &other_kernel, 5e-5, NEAR), DEM_LAW_MISMATCH);
    for (int k = 0; k < 3; k++) { /* as many states, but of another meaning */
        dem_law law = spring;
        dem_link_kernel kernel = spring_kernel;
        kernel.law = &law;
        law.name = k == 0 ? "spri" : k == 1 ? "spring of another kind" : law.name, law.version += k == 2;
        assert_int_equal(dem_set_links(&copy, &kernel, 5e-5, NEAR), DEM_LAW_MISMATCH);
        assert_int_equal(dem_set_links(&w, &kernel, 5e-5, NEAR), DEM_LAW_MISMATCH);
    }
    assert_int_equal(dem_set_links(&copy, &spring_kernel, 5e-5, NEAR), DEM_OK);
    assert_int_equal(dem_run_law(&w, 0.01, &crowd_kernel), DEM_OK);
    assert_int_equal(dem_run_law(&copy, 0.01, &crowd_kernel), DEM_OK);
    assert_true(dem_hash(&w) == dem_hash(&copy));
    free(bytes), free(again);
    dem_free(&w), dem_free(&copy);
}

/* In which order links end with their spheres does not depend on a save in between: a new list of a sphere's links is
   in another order. */
static void test_order_of_ends(void **state) {
    (void)state;
    enum { SPHERES = 14 };
    dem_world w;
    scene_random r = {3};
    make(&w, 4e-6, dem_vec3(0, 0, 0));
    for (int k = 0; k < SPHERES; k++) add(&w, 0.01 * k, 0, 0);
    assert_int_equal(dem_set_links(&w, &spring_kernel, 5e-5, NEAR), DEM_OK);
    for (int k = 0; k < 60; k++) {
        const int i = (int)(SPHERES * scene_uniform(&r)), j = (int)(SPHERES * scene_uniform(&r));
        const double state_of[SPRING_STATES] = {0.1 * k, 1.0, 0.0};
        if (i != j && dem_find_link(&w, i, j, 0) < 0) assert_int_equal(dem_add_link(&w, i, j, 0, state_of), DEM_OK);
    }
    for (int gone = 0; gone < 8; gone++) {
        dem_world copy;
        const size_t size = dem_save(&w, NULL, 0);
        unsigned char *bytes = malloc(size);
        assert_int_equal(dem_save(&w, bytes, size), size);
        assert_int_equal(dem_load(&copy, bytes, size, NULL), DEM_OK);
        assert_int_equal(dem_set_links(&copy, &spring_kernel, 5e-5, NEAR), DEM_OK);
        assert_true(dem_hash(&copy) == dem_hash(&w));
        assert_int_equal(dem_remove(&w, gone), DEM_OK);
        assert_int_equal(dem_remove(&copy, 0), DEM_OK);
        assert_true(dem_hash(&copy) == dem_hash(&w) && dem_link_count(&w) > 0);
        free(bytes);
        dem_free(&copy);
    }
    dem_free(&w);
}

static void test_near_is_contact(void **state) {
    (void)state;
    for (int linked = 0; linked < 2; linked++) {
        dem_world w;
        const double nothing[SPRING_STATES] = {0.0, 1.0, 0.0};
        make(&w, 4e-6, dem_vec3(0, 0, 0));
        add(&w, 0, 0, 0), add(&w, SIZE + 1.5e-6, 0, 0);
        assert_int_equal(dem_set_links(&w, &spring_kernel, 1e-4, NEAR), DEM_OK);
        if (linked) assert_int_equal(dem_add_link(&w, 1, 0, 0, nothing), DEM_OK);
        assert_int_equal(dem_run_law(&w, 1e-4, &crowd_kernel), DEM_OK);
        assert_int_equal(dem_contact_count(&w), linked);
        dem_free(&w);
    }
}

static void test_leaving(void **state) {
    (void)state;
    dem_world w;
    long ended = 0;
    const double spring_state[SPRING_STATES] = {1.0, 1.0, 0.0};
    make(&w, 4e-6, dem_vec3(0, 0, 0));
    w.user = &ended;
    for (int k = 0; k < 5; k++) add(&w, 6e-3 * k, 0, 0);
    assert_int_equal(dem_set_links(&w, &spring_kernel, 1e-4, 0.0), DEM_OK);
    for (int k = 0; k < 4; k++) assert_int_equal(dem_add_link(&w, k, k + 1, 0, spring_state), DEM_OK);
    assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR), DEM_OK);
    assert_int_equal(dem_remove(&w, 2), DEM_OK);
    assert_int_equal(ended, 2);
    assert_int_equal(dem_link_count(&w), 2);
    assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR), DEM_OK);
    assert_int_equal(w.count, 4);
    assert_int_equal(dem_find_link(&w, 0, 1, 0) >= 0, 1);
    assert_int_equal(dem_find_link(&w, 2, 3, 0) >= 0, 1);
    const double left = dem_mass(&w, 0) * (dem_velocity(&w, 0).x + dem_velocity(&w, 1).x);
    assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR), DEM_OK);
    assert_true(fabs(dem_mass(&w, 0) * (dem_velocity(&w, 0).x + dem_velocity(&w, 1).x) - left) <
                1e-12 * dem_mass(&w, 0)); /* nothing pulls from outside */
    dem_free(&w);
}

static void test_hostile_calls(void **state) {
    (void)state;
    dem_world w;
    const double spring_state[SPRING_STATES] = {1.0, 1.0, 0.0};
    make(&w, 4e-6, dem_vec3(0, 0, 0));
    add(&w, 0, 0, 0), add(&w, 6e-3, 0, 0);
    assert_int_equal(dem_add_link(&w, 0, 1, 0, spring_state), DEM_BAD_ARGUMENT); /* no law yet */
    assert_int_equal(dem_set_links(NULL, &spring_kernel, 1e-4, 0.0), DEM_BAD_ARGUMENT);
    dem_link_kernel none = spring_kernel;
    none.law = NULL;
    assert_int_equal(dem_set_links(&w, &none, 1e-4, 0.0), DEM_BAD_ARGUMENT);
    none = spring_kernel, none.loop = NULL;
    assert_int_equal(dem_set_links(&w, &none, 1e-4, 0.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_links(&w, NULL, 1e-4, 0.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_links(&w, &spring_kernel, 0.0, 0.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_links(&w, &spring_kernel, (double)NAN, 0.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_links(&w, &spring_kernel, 1e-4, -1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_links(&w, &spring_kernel, 1e-4, (double)NAN), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_links(&w, &spring_kernel, 1e-4, 0.0), DEM_OK);
    assert_int_equal(dem_add_link(&w, 0, 0, 0, spring_state), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_link(&w, 0, 2, 0, spring_state), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_link(&w, -1, 1, 0, spring_state), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_link(&w, 0, -1, 0, spring_state), DEM_BAD_ARGUMENT); /* no such wall */
    assert_int_equal(dem_add_link(&w, 0, 1, 0, NULL), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_link_count(NULL), 0);
    assert_int_equal(dem_find_link(NULL, 0, 1, 0), -1);
    assert_int_equal(dem_find_link(&w, 7, 1, 0), -1);
    assert_true(isnan(dem_get_link(&w, 0).gap));
    assert_int_equal(dem_add_link(&w, 0, 1, 0, spring_state), DEM_OK);
    assert_int_equal(dem_set_links(&w, &spring_kernel, 1e-4, 1e-3), DEM_OK);
    assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR), DEM_BAD_DEFINITION); /* near is too far for the list */
    dem_free(&w);
}

static void test_memory_running_out(void **state) {
    (void)state;
    int finished = 0;
    for (int k = 0; !finished; k++) {
        failing_allocator memory;
        dem_allocator hook;
        dem_world w;
        failing_init_at(&memory, k);
        hook.fn = failing_fn;
        hook.user = &memory;
        dem_status status = make_crowd(&w, SCENE_SCREEN, DEM_SKIP_ALL, 1, &hook);
        if (status == DEM_OK) status = dem_run_law(&w, 0.02, &crowd_kernel);
        assert_true(memory.has_failed ? status == DEM_OUT_OF_MEMORY : status == DEM_OK);
        finished = !memory.has_failed;
        dem_free(&w);
        assert_int_equal(memory.live, 0);
        assert_int_equal(memory.misused, 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_oscillation),
        cmocka_unit_test(test_angular_momentum),
        cmocka_unit_test(test_ledger),
        cmocka_unit_test(test_hanging),
        cmocka_unit_test(test_near_is_contact),
        cmocka_unit_test(test_skipping_and_threads),
        cmocka_unit_test(test_saving),
        cmocka_unit_test(test_order_of_ends),
        cmocka_unit_test(test_leaving),
        cmocka_unit_test(test_hostile_calls),
        cmocka_unit_test(test_memory_running_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
