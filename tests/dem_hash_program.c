/* dem_hash_program.c: runs the scenes of dem_scenes.h and dem_guard_scenes.h and prints their hashes, one a line. Compiled in many ways and run with several
   numbers of threads by tests/check_dem: the lines must not differ. Usage: dem_hash_program [threads] */
#include <stdio.h>
#include <stdlib.h>

#include "dem_guard_scenes.h"

int main(int argc, char **argv) {
    const int threads = argc > 1 ? atoi(argv[1]) : 1;
    if (!dem_build_is_deterministic()) {
        printf("this build fuses products or keeps more digits\n");
        return 1;
    }
    for (int scene = 0; scene < SCENE_COUNT; scene++) {
        dem_world world;
        dem_status status = scene_make(&world, scene, DEM_SKIP_ALL, threads, NULL);
        if (status == DEM_OK) status = dem_run(&world, scene_duration(scene), scene_features(scene));
        printf("%-8s %016llx %s\n", scene_name(scene), (unsigned long long)dem_hash(&world),
               status == DEM_OK ? "" : dem_status_text(status));
        dem_free(&world);
    }
    for (int scene = 0; scene < GUARD_COUNT; scene++) {
        uint64_t hash;
        const dem_status status = guard_run(scene, threads, &hash);
        printf("%-12s %016llx %s\n", guard_name(scene), (unsigned long long)hash, status == DEM_OK ? "" : dem_status_text(status));
    }
    return 0;
}
