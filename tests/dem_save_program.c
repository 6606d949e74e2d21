/* dem_save_program.c: saves a world of three materials in mid-run to a file, or loads it and runs on. tests/check_dem
   compiles it with several
   DEM_MATERIALS_MAX: the files must be the same, and so must what follows. Usage: dem_save_program save|load FILE */
#include <stdio.h>

#include "dem.h"

static int run_on(dem_world *w) {
    const dem_status status = dem_run(w, 3e-5, DEM_LINEAR | DEM_FRICTION);
    printf("%016llx %d contacts, %s\n", (unsigned long long)dem_hash(w), (int)dem_contact_count(w),
           dem_status_text(status));
    dem_free(w);
    return status != DEM_OK;
}

int main(int argc, char **argv) {
    static unsigned char bytes[1 << 17];
    const int saves = argc == 3 && argv[1][0] == 's';
    FILE *f = argc == 3 ? fopen(argv[2], saves ? "wb" : "rb") : NULL;
    dem_world w;
    if (!f) return 2;
    if (!saves) {
        const size_t size = fread(bytes, 1, sizeof bytes, f);
        fclose(f);
        const dem_status status = dem_load(&w, bytes, size, NULL);
        return status == DEM_OK ? run_on(&w) : (puts(dem_status_text(status)), 1);
    }
    dem_def def = dem_default_def();
    for (int a = 0; a < 3; a++) {
        dem_add_material(&def, 2500.0 + a, 1e9, 0.2);
        for (int b = 0; b <= a; b++)
            dem_pair(&def, a, b)->friction = 0.1 * (1 + a) + 0.02 * b,
                              dem_pair(&def, a, b)->stiffness = 500.0 * (1 + a);
    }
    if (dem_init(&w, &def, NULL) != DEM_OK || dem_add_plane(&w, 2, dem_vec3(0, 0, 0), dem_vec3(0.1, 0, 1)) < 0)
        return 1;
    for (int i = 0; i < 6; i++) {
        const double at[3] = {9.9e-4 * i, 0, 4.9e-4}, diameter = 1e-3;
        if (dem_add_spheres(&w, 1, at, &diameter, i % 2, 0) != DEM_OK) return 1;
    }
    if (dem_run(&w, 3e-5, DEM_LINEAR | DEM_FRICTION) != DEM_OK) return 1;
    const size_t size = dem_save(&w, bytes, sizeof bytes);
    if (size > sizeof bytes || fwrite(bytes, 1, size, f) != size || fclose(f) != 0) return 1;
    return run_on(&w);
}
