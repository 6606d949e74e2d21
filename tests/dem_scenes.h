/* dem_scenes.h: small scenes that together use every part of dem.h, for tests of bits, threads, saves and skipping. */
#ifndef RIDDLE_DEM_SCENES_H
#define RIDDLE_DEM_SCENES_H

#include <string.h>

#include "dem.h"
#include "../examples/common/random.h"

typedef struct scene_random {
    uint64_t state;
} scene_random;

static inline double scene_uniform(scene_random *r) { return random_share(&r->state); }
static inline double scene_between(scene_random *r, double low, double high) {
    return low + (high - low) * scene_uniform(r);
}
static inline dem_vec scene_vector(scene_random *r, double size) {
    dem_vec v;
    v.x = scene_between(r, -size, size);
    v.y = scene_between(r, -size, size);
    v.z = scene_between(r, -size, size);
    return v;
}

enum { SCENE_GAS, SCENE_BED, SCENE_SCREEN, SCENE_SIZES, SCENE_PERIODIC, SCENE_DRUM, SCENE_DEEP, SCENE_COUNT };

static inline const char *scene_name(int scene) {
    static const char *const name[] = {"gas", "bed", "screen", "sizes", "periodic", "drum", "deep"};
    return name[scene];
}

static inline int scene_features(int scene) {
    switch (scene) {
    case SCENE_GAS: return DEM_LINEAR;
    case SCENE_BED:
    case SCENE_DEEP: return DEM_LINEAR | DEM_FRICTION;
    case SCENE_SCREEN: return DEM_LINEAR | DEM_FRICTION | DEM_ROLLING;
    case SCENE_SIZES: return DEM_HERTZ | DEM_FRICTION;
    case SCENE_PERIODIC: return DEM_HERTZ;
    default: return DEM_HERTZ | DEM_FRICTION | DEM_ROLLING;
    }
}

static inline double scene_duration(int scene) {
    static const double duration[] = {0.05, 0.012, 0.08, 0.008, 0.03, 0.03, 0.003};
    return duration[scene];
}

/* The threads of all scenes: NULL for those of dem.h. */
static void (*scene_parallel)(void *user, int tasks, void (*task)(void *context, int index), void *context);

static inline dem_def scene_def(double dt) {
    dem_def def = dem_default_def();
    def.parallel = scene_parallel;
    int glass = dem_add_material(&def, 2534.1, 5e7, 0.2), steel = dem_add_material(&def, 7800.0, 2e8, 0.3);
    dem_pair_def *p = dem_pair(&def, glass, glass), *q = dem_pair(&def, glass, steel);
    def.dt = dt;
    p->restitution = 0.7808, p->friction = 0.2, p->rolling = 5e-5;
    q->restitution = 0.4351, q->friction = 0.3, q->rolling = 8e-5, q->tangential_damping = 0.1, q->mode = DEM_NAIVE;
    return def;
}

/* Spheres on a jittered lattice of a given pitch, with random velocities and spins; sizes[k % kinds] are diameters. */
static inline dem_status scene_fill(dem_world *w, scene_random *r, int nx, int ny, int nz, dem_vec corner, double pitch,
                                    const double *sizes, int kinds, double speed) {
    for (int k = 0; k < nx * ny * nz; k++) {
        double d = sizes[k % kinds] * scene_between(r, 0.97, 1.0), room = 0.5 * (pitch - d);
        double at[3] = {corner.x + pitch * (k % nx + 0.5), corner.y + pitch * (k / nx % ny + 0.5),
                        corner.z + pitch * (k / nx / ny + 0.5)};
        dem_status status;
        for (int a = 0; a < 3; a++) at[a] += scene_between(r, -room, room);
        status = dem_add_spheres(w, 1, at, &d, 0, k % kinds);
        if (status != DEM_OK) return status;
        /* In this order, whatever the compiler. */
        dem_vec v = scene_vector(r, speed), spin = scene_vector(r, 20.0 * speed);
        status = dem_set_motion(w, w->count - 1, v, spin);
        if (status != DEM_OK) return status;
    }
    return DEM_OK;
}

/* A law for links: springs between surfaces, that tear at a gap. */
enum { STIFFNESS, LIMIT, DRAG, SPRING_STATES }; /* state: [N/m], [m], [kg/s] */
DEM_INLINE void scene_spring_force(const dem_contact *c, double *state, dem_response *r) {
    r->normal = -state[STIFFNESS] * c->gap + state[DRAG] * c->closing;
    for (int a = 0; a < 3; a++) r->tangential[a] = -state[DRAG] * c->slip[a];
    r->ended = c->gap > state[LIMIT] ? 1.0 : 0.0;
}

static inline void scene_box(dem_world *w, double half, double low, double high) {
    dem_add_plane(w, 1, dem_vec3(-half, 0, 0), dem_vec3(1, 0, 0));
    dem_add_plane(w, 1, dem_vec3(half, 0, 0), dem_vec3(-1, 0, 0));
    dem_add_plane(w, 1, dem_vec3(0, -half, 0), dem_vec3(0, 1, 0));
    dem_add_plane(w, 1, dem_vec3(0, half, 0), dem_vec3(0, -1, 0));
    dem_add_plane(w, 1, dem_vec3(0, 0, low), dem_vec3(0, 0, 1));
    dem_add_plane(w, 1, dem_vec3(0, 0, high), dem_vec3(0, 0, -1));
}

/* Makes a scene; allocator may be NULL. The caller frees the world whatever the status. */
static inline dem_status scene_make(dem_world *w, int scene, int skip, int threads, const dem_allocator *allocator) {
    scene_random r = {(uint64_t)scene * 1000 + 7};
    const double mixed[3] = {5e-3, 7e-3, 10e-3}, one = 5e-3;
    dem_def def = scene_def(4e-6);
    dem_status status;
    def.skip = skip;
    def.threads = threads;
    if (allocator) def.allocator = *allocator;
    if (scene == SCENE_SIZES) def.dt = 1e-6;
    if (scene == SCENE_GAS || scene == SCENE_PERIODIC) def.gravity = dem_vec3(0, 0, 0);
    if (scene == SCENE_SCREEN) def.gravity = dem_vec3(0, 0, -30); /* so that things happen soon */
    if (scene == SCENE_BED) {
        def.gravity = dem_vec3(0, 0, -150);
        def.periodic[0] = def.periodic[1] = 1;
        def.low = dem_vec3(-0.0232, -0.0233, 0);
        def.high = dem_vec3(0.0232, 0.0233, 1);
    }
    if (scene == SCENE_DEEP) {
        def.periodic[0] = def.periodic[1] = 1;
        def.high = dem_vec3(0.0784, 0.0784, 1);
    }
    if (scene == SCENE_PERIODIC) {
        def.periodic[0] = def.periodic[1] = def.periodic[2] = 1;
        def.low = dem_vec3(-0.03, -0.02, -0.025);
        def.high = dem_vec3(0.03, 0.04, 0.035);
    }
    status = dem_init(w, &def, NULL);
    if (status != DEM_OK) return status;
    switch (scene) {
    case SCENE_GAS:
        scene_box(w, 0.05, -0.05, 0.05);
        return scene_fill(w, &r, 5, 5, 5, dem_vec3(-0.05, -0.05, -0.05), 0.02, &one, 1, 2.0);
    case SCENE_BED: {
        int floor_plane = dem_add_plane(w, 1, dem_vec3(0, 0, 0), dem_vec3(0.02, 0.01, 1));
        if (floor_plane < 0) return (dem_status)-floor_plane;
        dem_vibrate(w, floor_plane, dem_vec3(2e-4, 0, 1e-3), dem_vec3(0, 0, -0.5), 50.6);
        return scene_fill(w, &r, 9, 9, 8, dem_vec3(-0.02295, -0.02295, 0), 5.1e-3, &one, 1, 0.2);
    }
    case SCENE_SCREEN: {
        dem_screen screen = dem_default_screen();
        int deck;
        screen.half_x = 0.04;
        screen.normal = dem_vec3(0.05, 0, 1);
        deck = dem_add_screen(w, 1, &screen);
        dem_add_cylinder(w, 1, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 0.04, 1);
        dem_add_exit(w, dem_vec3(0, 0, -0.012), dem_vec3(0, 0, 1));
        dem_add_exit(w, dem_vec3(0, 0, -0.0121), dem_vec3(0, 0.001, 1));
        dem_vibrate(w, deck, dem_vec3(1e-3, 0, 1.5e-3), dem_vec3(0.5 * RIDDLE_PI, 0, 0), 50.6);
        return scene_fill(w, &r, 5, 5, 6, dem_vec3(-0.0275, -0.0275, 0.004), 0.011, mixed, 3, 0.3);
    }
    case SCENE_SIZES: {
        const double big = 10e-3, tiny = 1e-3;
        scene_box(w, 0.011, 0.0, 0.05);
        status = scene_fill(w, &r, 2, 2, 2, dem_vec3(-0.0105, -0.0105, 0.006), 0.0105, &big, 1, 0.2);
        return status != DEM_OK ? status
                                : scene_fill(w, &r, 12, 12, 4, dem_vec3(-0.0072, -0.0072, 0), 1.2e-3, &tiny, 1, 0.2);
    }
    case SCENE_PERIODIC: return scene_fill(w, &r, 5, 5, 5, dem_vec3(-0.03, -0.02, -0.025), 0.012, mixed, 3, 1.5);
    case SCENE_DEEP: {
        /* Enough for sections of contacts and for rings: 5376 spheres that overlap and fly apart, on a floor
           that beats them. */
        const int floor_plane = dem_add_plane(w, 1, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
        if (floor_plane < 0) return (dem_status)-floor_plane;
        dem_vibrate(w, floor_plane, dem_vec3(0, 0, 1e-3), dem_vec3(0, 0, 0), 200.0);
        return scene_fill(w, &r, 16, 16, 21, dem_vec3(0, 0, 0), 4.9e-3, &one, 1, 0.3);
    }
    default: {
        int drum = dem_add_cylinder(w, 1, dem_vec3(0, 0, 0), dem_vec3(0, 1, 0), 0.04, 1), k;
        dem_rotate(w, drum, dem_vec3(0, 0, 0.001), dem_vec3(0, 1, 0.01), 12.0);
        dem_add_plane(w, 1, dem_vec3(0, -0.015, 0), dem_vec3(0, 1, 0));
        dem_add_plane(w, 1, dem_vec3(0, 0.015, 0), dem_vec3(0, -1, 0));
        k = dem_add_cylinder(w, 1, dem_vec3(0, 0, -0.02), dem_vec3(0, 1, 0), 4e-3, 0);
        dem_rotate(w, k, dem_vec3(0, 0, 0), dem_vec3(0, 1, 0), -8.0);
        dem_move(w, k, dem_vec3(0.05, 0, 0));
        status = scene_fill(w, &r, 6, 4, 6, dem_vec3(-0.021, -0.014, -0.007), 7e-3, &mixed[0], 1, 0.3);
        if (status == DEM_OK) status = dem_set_load(w, 3, dem_vec3(0.001, 0, -0.002), dem_vec3(0, 1e-6, 0));
        return status;
    }
    }
}

#endif
