/* test_dem_guard.c: what must hold inside a world, in every scene of dem_scenes.h and dem_guard_scenes.h and after
   every kind of change; a world that was saved goes on as if it had not been. */
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "at_once.h"
#include "dem_bad_calls.h"
#include "dem_guard_scenes.h"
#include "dem_invariants.h"

static void check(const dem_world *w, const char *name) {
    int32_t *scratch = (int32_t *)malloc(((size_t)w->count + 1) * sizeof *scratch);
    assert_non_null(scratch);
    const char *broken = dem_broken_invariant(w, scratch);
    free(scratch);
    if (broken) fail_msg("%s, step %ld: %s", name, (long)w->step, broken);
}

static void test_scenes_hold(void **state) {
    (void)state;
    for (int scene = 0; scene < SCENE_COUNT; scene++) {
        for (int threads = 1; threads < 3; threads++) {
            dem_world w;
            const int parts = scene == SCENE_DEEP ? 1 : 7; /* every pair is asked: few looks at a large one */
            assert_int_equal(scene_make(&w, scene, DEM_SKIP_ALL, threads, NULL), DEM_OK);
            for (int part = 0; part < parts; part++) {
                assert_int_equal(dem_run(&w, scene_duration(scene) / parts, scene_features(scene)), DEM_OK);
                check(&w, scene_name(scene));
            }
            dem_free(&w);
        }
    }
}

static void test_guard_scenes_hold(void **state) {
    (void)state;
    for (int k = 0; k < 3; k++) {
        dem_world w;
        const int features = DEM_LINEAR | DEM_FRICTION | DEM_ROLLING;
        assert_int_equal(k == 0   ? guard_links_begin(&w, 1, 4e-5)
                         : k == 1 ? guard_mesh_begin(&w, 1)
                                  : guard_driven_begin(&w, 1),
                         DEM_OK);
        for (int part = 0; part < 12; part++) {
            assert_int_equal(dem_run(&w, 377.0 * w.def.dt, features), DEM_OK);
            check(&w, guard_name(GUARD_LINKS + k));
        }
        dem_free(&w);
    }
}

/* What a host does between two runs. */
static void change(dem_world *w, int part) {
    const double late[3] = {0, 0, 0.05}, one = 4e-3;
    const dem_region part_of = dem_box_region(dem_vec3(-0.02, -0.02, 0.03), dem_vec3(0, 0, 0.1));
    const ptrdiff_t last = w->count - 1;
    switch (part) {
    case 0: assert_int_equal(dem_add_spheres(w, 1, late, &one, 0, 0), DEM_OK); break;
    case 1: assert_int_equal(dem_remove(w, 3), DEM_OK); break;
    case 2: assert_int_equal(dem_set_motion(w, last, dem_vec3(1, 0, -1), dem_vec3(0, 0, 0)), DEM_OK); break;
    case 3: assert_int_equal(dem_enable_wall(w, 4, 0), DEM_OK); break;
    case 4: assert_int_equal(dem_enable_wall(w, 4, 1), DEM_OK); break;
    case 5: assert_int_equal(dem_set_time_step(w, 3e-6), DEM_OK); break;
    case 6: assert_true(dem_add_plane(w, 1, dem_vec3(0, 0, 0.001), dem_vec3(0, 0, 1)) >= 0); break;
    case 7: assert_true(dem_remove_region(w, &part_of) >= 0); break;
    case 8: assert_int_equal(dem_set_load(w, last, dem_vec3(1e-3, 0, 0), dem_vec3(0, 0, 0)), DEM_OK); break;
    default: assert_int_equal(guard_reload(w), DEM_OK); break;
    }
}

static void test_changes_hold(void **state) {
    (void)state;
    for (int features = 0; features < 2; features++) {
        dem_world w;
        uint64_t hash = 0;
        assert_int_equal(
            guard_ledger(&w, 1, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | (features ? DEM_ENERGY : 0), &hash), DEM_OK);
        for (int part = 0; part < 10; part++) {
            change(&w, part);
            check(&w, "after a change");
            assert_int_equal(dem_run(&w, 321.0 * w.def.dt, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING), DEM_OK);
            check(&w, "after a run");
        }
        dem_free(&w);
    }
}

static void test_checker_sees(void **state) {
    (void)state;
    dem_world w;
    int32_t scratch[400];
    assert_int_equal(guard_driven_begin(&w, 1), DEM_OK);
    assert_int_equal(dem_run(&w, 0.01, DEM_LINEAR), DEM_OK);
    assert_null(dem_broken_invariant(&w, scratch));
    assert_true(dem_contact_count(&w) > 10 && w.count <= 400);
    w.touching[w.engine->contacts.i[w.engine->contacts.chunk[0].first]]++;
    assert_non_null(dem_broken_invariant(&w, scratch));
    w.touching[w.engine->contacts.i[w.engine->contacts.chunk[0].first]]--;
    w.engine->pairs.timers.due[0] = (int32_t)(w.step - w.engine->pairs.timers.from);
    assert_non_null(dem_broken_invariant(&w, scratch));
    dem_free(&w);
}

static void test_saved_goes_on(void **state) {
    (void)state;
    for (int threads = 1; threads < 3; threads++) {
        uint64_t hash[2] = {0, 0};
        for (int saves = 0; saves < 2; saves++) {
            dem_world w;
            assert_int_equal(guard_saved(&w, threads, saves, &hash[saves]), DEM_OK);
            dem_free(&w);
        }
        assert_true(hash[0] == hash[1]);
    }
}

/* A host's own threads: tasks in another order, on a thread each. */
static void pool_run(void *user, int tasks, void (*task)(void *context, int index), void *context) {
    assert_in_range(tasks, 2, 8);
    assert_int_equal(run_at_once(tasks, task, context), tasks);
    ++*(int *)user;
}
static void test_threads_of_a_host(void **state) {
    (void)state;
    uint64_t hash[2];
    int loops = 0;
    for (int own = 0; own < 2; own++) {
        dem_world w;
        assert_int_equal(scene_make(&w, SCENE_DEEP, DEM_SKIP_ALL, own ? 5 : 1, NULL), DEM_OK);
        if (own) w.def.parallel = pool_run, w.def.parallel_user = &loops;
        assert_int_equal(dem_run(&w, scene_duration(SCENE_DEEP) / 10, scene_features(SCENE_DEEP)), DEM_OK);
        hash[own] = dem_hash(&w);
        dem_free(&w);
    }
    assert_true(hash[0] == hash[1] && loops > 0);
    assert_true(sizeof(dem_world) <= 6 * 1024);
}

/* Threads that read one world at once: none writes anything of it. */
typedef struct reading {
    const dem_world *world;
    uint64_t hash;
    size_t size;
    unsigned char *bytes;
} reading;
static void *reader(void *of) {
    reading *r = (reading *)of;
    for (int k = 0; k < 40; k++) {
        r->hash = dem_hash(r->world);
        r->size = dem_save(r->world, NULL, 0);
        if (dem_save(r->world, r->bytes, r->size) != r->size || dem_hash(r->world) != r->hash) r->size = 0;
    }
    return NULL;
}
static void test_readers_write_nothing(void **state) {
    (void)state;
    dem_world w;
    pthread_t thread[2];
    reading of[2];
    assert_int_equal(guard_mesh_begin(&w, 1), DEM_OK);
    assert_int_equal(dem_run(&w, 377.0 * w.def.dt, DEM_HERTZ | DEM_FRICTION), DEM_OK);
    assert_int_equal(dem_remove(&w, 3), DEM_OK);
    const uint64_t before = dem_hash(&w);
    for (int k = 0; k < 2; k++) {
        of[k].world = &w, of[k].bytes = (unsigned char *)malloc(dem_save(&w, NULL, 0));
        assert_non_null(of[k].bytes);
    }
    for (int k = 0; k < 2; k++) assert_int_equal(pthread_create(&thread[k], NULL, reader, &of[k]), 0);
    for (int k = 0; k < 2; k++) pthread_join(thread[k], NULL);
    assert_true(of[0].size > 0 && of[0].size == of[1].size && of[0].hash == before && of[1].hash == before);
    assert_memory_equal(of[0].bytes, of[1].bytes, of[0].size);
    check(&w, "after readers");
    for (int k = 0; k < 2; k++) free(of[k].bytes);
    dem_free(&w);
}

/* Threads that lose time are left alone for longer and longer, and come back. */
static void test_threads_that_lose(void **state) {
    (void)state;
#ifdef _OPENMP
    dem__pace pace;
    const double fair[2] = {1e-4, 1e-4}, late[2] = {1e-4, 5e-3};
    double now = 1.0, rest = 0.01;
    memset(&pace, 0, sizeof pace);
    for (int k = 0; k < 1000; k++) dem__judge_threads(&pace, now, now + 1.1e-4, fair, 2); /* both at once: a gain */
    assert_true(pace.loss == 0.0 && pace.alone_until == 0.0);
    for (int k = 0; k < 9; k++) dem__judge_threads(&pace, now, now + 4e-4, fair, 2); /* 2e-4 s lost each time */
    assert_true(pace.loss > 1.7e-3 && pace.alone_until == 0.0);
    dem__judge_threads(&pace, now, now + 1.1e-4, fair, 2);
    assert_true(pace.loss < 1.8e-3);
    for (int k = 0; k < 9; k++) { /* one long wait each time that they are tried again */
        dem__judge_threads(&pace, now, now + 5e-3, late, 2);
        rest = 2.0 * rest < 2.0 ? 2.0 * rest : 2.0;
        assert_true(fabs(pace.rest - rest) < 1e-12 && fabs(pace.alone_until - (now + 5e-3 + rest)) < 1e-12);
        now = pace.alone_until;
    }
    assert_true(pace.rest == 2.0);
    now += 11.0; /* after long good times the first rest is short again */
    dem__judge_threads(&pace, now, now + 5e-3, late, 2);
    assert_true(fabs(pace.rest - 0.02) < 1e-12);
    dem_world w; /* what is left alone runs all the same */
    uint64_t hash[2];
    for (int alone = 0; alone < 2; alone++) {
        assert_int_equal(scene_make(&w, SCENE_DEEP, DEM_SKIP_ALL, 2, NULL), DEM_OK);
        w.engine->pace.alone_until = alone ? HUGE_VAL : 0.0;
        assert_int_equal(dem_run(&w, scene_duration(SCENE_DEEP) / 40, scene_features(SCENE_DEEP)), DEM_OK);
        hash[alone] = dem_hash(&w);
        dem_free(&w);
    }
    assert_true(hash[0] == hash[1]);
#else
    skip();
#endif
}

/* A call that is refused changes nothing and says which argument is wrong; each text belongs to its own call. */
static void test_refusals_are_told(void **state) {
    (void)state;
    static int (*const group[])(bad_calls *, int, const char **) = {bad_wall, bad_motion_of_wall, bad_body, bad_feed,
                                                                    bad_setting};
    bad_calls b;
    int calls = 0;
    assert_true(bad_calls_begin(&b));
    assert_string_equal(dem_error_text(&b.world), "");
    const uint64_t before = dem_hash(&b.world);
    for (size_t g = 0; g < sizeof group / sizeof group[0]; g++) {
        const char *argument = NULL;
        for (int k = 0, status; b.world.refusal = NULL, (status = group[g](&b, k, &argument)) != 0; k++, calls++) {
            const char *text = dem_error_text(&b.world);
            if (status != -(int)DEM_BAD_ARGUMENT || !strstr(text, argument) || !strchr(text, ' ') || strlen(text) > 120)
                fail_msg("group %d, call %d, \"%s\": status %d, \"%s\"", (int)g, k, argument, status, text);
        }
    }
    assert_int_equal(calls, 93);
    assert_true(dem_hash(&b.world) == before);
    assert_int_equal(dem_set_time_step(&b.world, -1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_time_step(&b.world, 1e-6), DEM_OK); /* leaves the text */
    assert_non_null(strstr(dem_error_text(&b.world), "dt: "));
    dem_free(&b.world);
    assert_string_equal(dem_error_text(&b.world), "");
    assert_int_equal(dem_set_gravity(&b.world, dem_vec3(0, 0, 0)), DEM_BAD_ARGUMENT);
    assert_non_null(strstr(dem_error_text(&b.world), "dem_init"));
    memset(&b.world, 0x55, sizeof b.world); /* its contents are not read */
    assert_int_equal(dem_load(&b.world, NULL, 0, NULL), DEM_BAD_ARGUMENT);
    assert_non_null(strstr(dem_error_text(&b.world), "buffer"));
    assert_int_equal(dem_load(&b.world, "", 0, NULL), DEM_BAD_DATA);
    assert_string_equal(dem_error_text(&b.world), "");
    assert_string_equal(dem_error_text(NULL), "");
    assert_int_equal(dem_set_gravity(NULL, dem_vec3(0, 0, 0)), DEM_BAD_ARGUMENT);
}

static dem_vec no_force(const dem_force_point *at) {
    (void)at;
    return dem_vec3(0, 0, 0);
}
DEM_FORCE_FIELD(no_field, no_force)

/* Links and a force field exclude each other; a body has no link with itself. */
static void test_refused_links(void **state) {
    (void)state;
    bad_calls b;
    assert_true(bad_calls_begin(&b));
    assert_int_equal(dem_set_links(&b.world, &guard_spring_kernel, 4e-5, 0.0), DEM_OK);
    const double states[DEM_STATE_MAX] = {0.0};
    assert_int_equal(dem_add_link(&b.world, 1, 2, 0, states), DEM_BAD_ARGUMENT);
    assert_non_null(strstr(dem_error_text(&b.world), "same body"));
    assert_int_equal(dem_add_link(&b.world, 0, -3, 0, states), DEM_BAD_ARGUMENT);
    assert_non_null(strstr(dem_error_text(&b.world), "j: "));
    const dem_force_field field = dem_default_force_field(no_field, NULL);
    assert_int_equal(dem_set_force_field(&b.world, &field), DEM_BAD_ARGUMENT);
    assert_non_null(strstr(dem_error_text(&b.world), "exclude"));
    dem_free(&b.world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scenes_hold),           cmocka_unit_test(test_guard_scenes_hold),
        cmocka_unit_test(test_changes_hold),          cmocka_unit_test(test_checker_sees),
        cmocka_unit_test(test_saved_goes_on),         cmocka_unit_test(test_threads_of_a_host),
        cmocka_unit_test(test_readers_write_nothing), cmocka_unit_test(test_threads_that_lose),
        cmocka_unit_test(test_refusals_are_told),     cmocka_unit_test(test_refused_links),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
