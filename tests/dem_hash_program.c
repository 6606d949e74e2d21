/* dem_hash_program.c: runs the scenes of dem_scenes.h and dem_guard_scenes.h and prints their hashes, one a line.
   Compiled in many ways and run with several numbers of threads by tests/check_dem: the lines must not differ.
   Usage: dem_hash_program [threads]
   With AT_ONCE each task of a loop has a thread of its own. With TWO_KERNELS only the scenes of two kernels are
   compiled, which takes half the time. */
#include <stdio.h>
#include <stdlib.h>

#ifdef AT_ONCE
#include "at_once.h"
#endif
#include "dem_guard_scenes.h"

#ifdef TWO_KERNELS
enum { SCENES = 3, GUARDS = 0 };
static const int scenes[SCENES] = {SCENE_BED, SCENE_SIZES, SCENE_DEEP};
static dem_status run(dem_world *world, int scene) {
    if (scene == SCENE_SIZES) return dem_run(world, scene_duration(scene), DEM_HERTZ | DEM_FRICTION);
    return dem_run(world, scene_duration(scene), DEM_LINEAR | DEM_FRICTION);
}
static dem_status run_guard(int scene, int threads, uint64_t *hash) {
    return (void)scene, (void)threads, (void)hash, DEM_BAD_ARGUMENT;
}
#else
enum { SCENES = SCENE_COUNT, GUARDS = GUARD_COUNT };
static const int scenes[SCENES] = {SCENE_GAS,      SCENE_BED,  SCENE_SCREEN, SCENE_SIZES,
                                   SCENE_PERIODIC, SCENE_DRUM, SCENE_DEEP};
static dem_status run(dem_world *world, int scene) {
    return dem_run(world, scene_duration(scene), scene_features(scene));
}
static dem_status run_guard(int scene, int threads, uint64_t *hash) { return guard_run(scene, threads, hash); }
#endif

#ifdef AT_ONCE
static void run_tasks(void *user, int tasks, void (*task)(void *context, int index), void *context) {
    (void)user;
    run_at_once(tasks, task, context);
}
#else
/* More threads than a machine may have: the tasks of a loop one after the other, the last one first. */
static void run_tasks(void *user, int tasks, void (*task)(void *context, int index), void *context) {
    (void)user;
    for (int k = tasks - 1; k >= 0; k--) task(context, k);
}
#endif

int main(int argc, char **argv) {
    const int threads = argc > 1 ? atoi(argv[1]) : 1;
    if (threads > 2) scene_parallel = run_tasks; /* OpenMP takes no more than there are processors */
    if (!dem_build_is_deterministic()) {
        printf("this build fuses products or keeps more digits\n");
        return 1;
    }
    for (int k = 0; k < SCENES; k++) {
        const int scene = scenes[k];
        dem_world world;
        dem_status status = scene_make(&world, scene, DEM_SKIP_ALL, threads, NULL);
        if (status == DEM_OK) status = run(&world, scene);
        printf("%-8s %016llx %s\n", scene_name(scene), (unsigned long long)dem_hash(&world),
               status == DEM_OK ? "" : dem_status_text(status));
        dem_free(&world);
    }
    for (int scene = 0; scene < GUARDS; scene++) {
        uint64_t hash;
        const dem_status status = run_guard(scene, threads, &hash);
        printf("%-12s %016llx %s\n", guard_name(scene), (unsigned long long)hash,
               status == DEM_OK ? "" : dem_status_text(status));
    }
    return 0;
}
