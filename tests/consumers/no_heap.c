/* A host without a heap: the world lives in a buffer of its own. Two spheres fall onto a floor and come to rest. */
#include "dem.h"

#include <stdio.h>
#include <string.h>

#if defined(NEEDS_OPENMP) && !defined(_OPENMP)
#error "riddle::openmp does not switch OpenMP on"
#endif

/* Hands out the buffer from its start; what is given back last can be given out again, nothing else. */
typedef struct arena {
    unsigned char *bytes;
    size_t size, used, last, most;
    int calls;
} arena;

static void *from_arena(void *user, void *old, size_t old_size, size_t new_size) {
    arena *a = (arena *)user;
    const size_t begin = (a->used + 63) / 64 * 64;
    a->calls++;
    if (new_size == 0) {
        if (old && (unsigned char *)old == a->bytes + a->last) a->used = a->last;
        return NULL;
    }
    if (new_size > a->size - begin) return NULL;
    void *fresh = a->bytes + begin;
    if (old) memcpy(fresh, old, old_size < new_size ? old_size : new_size);
    a->last = begin;
    a->used = begin + new_size;
    if (a->used > a->most) a->most = a->used;
    return fresh;
}

static double buffer[1 << 20]; /* 8 MiB */

int main(void) {
    arena memory = {(unsigned char *)buffer, sizeof buffer, 0, 0, 0, 0};
    const double centres[] = {0.0, 0.0, 0.01, 0.0, 0.0005, 0.03}, diameters[] = {0.01, 0.012};
    dem_def def = dem_default_def();
    dem_world world;
    const int glass = dem_add_material(&def, 2500.0, 1e9, 0.2);
    def.allocator.fn = from_arena;
    def.allocator.user = &memory;
    def.dt = 1e-5;
    memset(&world, 0, sizeof world);
    if (dem_init(&world, &def, NULL) != DEM_OK) return 1;
    if (dem_add_plane(&world, glass, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) < 0) return 2;
    if (dem_add_spheres(&world, 2, centres, diameters, glass, 0) != DEM_OK) return 3;
    if (dem_run(&world, 1.0, DEM_LINEAR | DEM_FRICTION) != DEM_OK) return 4;
    const double z = dem_position(&world, 0).z;
    printf("at rest at %.5f m; %lu bytes of the buffer, %d calls\n", z, (unsigned long)memory.most, memory.calls);
    dem_free(&world);
    return !(z > 0.0049 && z < 0.0051);
}
