/* Any scene: what is skipped, how many threads there are and a save in between change no bit of it. Scenes are drawn
   from the bytes: walls of every kind in every motion, periodic axes, sizes, loads, links, and changes between runs. */
#include "fuzz.h"

#include "dem_scenes.h"

static const dem_law spring = {"spring", 1, SPRING_STATES, 0, 0, 0, NULL, scene_spring_force, NULL, NULL};
DEM_LINK_KERNEL(spring_kernel, spring)

/* ---- a scene ---- */

#define HALF 0.03 /* of its box [m] */

static int one_of(scene_random *r, int n) { return (int)(scene_uniform(r) * n); }
static dem_vec place(scene_random *r) { return scene_vector(r, HALF); }

static void swing(void *user, double time, dem_pose *pose) {
    (void)user;
    pose->shift = dem_vec3(1e-3 * sin(300.0 * time), 0.0, 2e-3 * sin(200.0 * time));
    pose->turn = dem_vec3(0.1 * sin(100.0 * time), 0.0, 2.0 * time);
}

static void draw_motion(dem_world *w, scene_random *r, int wall) {
    const dem_vec a = scene_vector(r, 2e-3), b = scene_vector(r, 3.0), axis = scene_vector(r, 1.0), centre = place(r);
    switch (one_of(r, 9)) {
    case 0: dem_vibrate(w, wall, a, b, scene_between(r, 0.0, 100.0)); break;
    case 1: dem_vibrate(w, wall, a, b, 50.0), dem_rotate(w, wall, centre, axis, 10.0); break;
    case 2: dem_move(w, wall, scene_vector(r, 0.3)); break;
    case 3: dem_rotate(w, wall, centre, axis, scene_between(r, -20.0, 20.0)); break;
    case 4: dem_prescribe(w, wall, centre, swing, NULL); break;
    case 5: dem_control_force(w, wall, axis, 0.05, scene_between(r, -1.0, 1.0), 0.1); break;
    case 6: dem_control_torque(w, wall, centre, axis, 1e-4, scene_between(r, -0.01, 0.01), 1e-4); break;
    default: break;
    }
    if (one_of(r, 5) == 0) dem_set_belt(w, wall, b);
}

static void draw_wall(dem_world *w, scene_random *r) {
    const dem_vec x = place(r), n = scene_vector(r, 1.0);
    const double size = scene_between(r, 2e-3, HALF);
    dem_screen screen = dem_default_screen();
    dem_cone cone = dem_default_cone();
    dem_disc disc = dem_default_disc();
    int wall = -1;
    switch (one_of(r, 9)) {
    case 0: wall = dem_add_plane(w, 1, dem__scale(HALF, n), dem__scale(-1.0, n)); break;
    case 1: wall = dem_add_cylinder(w, 1, x, n, size, 0); break;
    case 2: wall = dem_add_cylinder(w, 1, dem_vec3(0, 0, 0), n, 2.0 * HALF, 1); break;
    case 3: wall = dem_add_sphere_wall(w, 1, x, size, one_of(r, 2)); break;
    case 4:
        cone.low = x, cone.high = place(r), cone.low_radius = size, cone.high_radius = scene_between(r, 0.0, HALF);
        wall = dem_add_cone(w, 1, &cone);
        break;
    case 5: wall = dem_add_box(w, 1, x, dem_vec3(x.x + size, x.y + scene_between(r, 1e-3, HALF), x.z + size)); break;
    case 6:
        screen.aperture = scene_between(r, 3e-3, 9e-3), screen.wire = scene_between(r, 1e-3, 3e-3);
        screen.half_x = size, screen.half_y = scene_between(r, 5e-3, HALF), screen.circular = one_of(r, 2);
        screen.profile = one_of(r, 2) ? DEM_ROUND : DEM_SEMICIRCLE;
        screen.centre = x, screen.normal = n, screen.direction = scene_vector(r, 1.0);
        wall = dem_add_screen(w, 1, &screen);
        break;
    case 7:
        disc.centre = x, disc.normal = n, disc.radius = size, disc.hole_radius = scene_between(r, 0.0, size);
        wall = dem_add_disc(w, 1, &disc);
        break;
    default: wall = dem_add_exit(w, dem__scale(2.0 * HALF, n), dem__scale(-1.0, n)); break;
    }
    if (wall >= 0) draw_motion(w, r, wall);
}

static dem_status draw_spheres(dem_world *w, scene_random *r, int count) {
    dem_feed feed = dem_default_feed();
    const double largest = scene_between(r, 3e-3, 9e-3);
    feed.region = dem_box_region(dem_vec3(-HALF, -HALF, -HALF), dem_vec3(HALF, HALF, HALF));
    feed.sizes =
        one_of(r, 2) ? dem_one_size(largest) : dem_uniform_sizes(scene_between(r, 0.15, 0.9) * largest, largest, 0);
    feed.material = one_of(r, 2);
    feed.scatter = dem_vec3(1.0, 1.0, 1.0);
    feed.velocity = scene_vector(r, 1.0);
    feed.tries = 100;
    feed.random = (uint64_t)(1e9 * scene_uniform(r));
    return dem_fill(w, &feed, count);
}

/* Enough contacts for sections, in a shaken box that some fall out of. */
static dem_status draw_crowd(dem_world *w, scene_random *r) {
    const double sizes[2] = {2.5e-3, scene_between(r, 2.3e-3, 2.5e-3)};
    const int n = 15 + one_of(r, 10);
    scene_box(w, HALF, -HALF, HALF);
    for (int k = 0; k < w->walls; k++) {
        if (one_of(r, 3) == 0) dem_vibrate(w, k, scene_vector(r, 5e-4), scene_vector(r, 3.0), 80.0);
    }
    for (int k = one_of(r, 3); k > 0; k--) dem_add_exit(w, place(r), scene_vector(r, 1.0));
    return scene_fill(w, r, n, n, 22, dem_vec3(-HALF, -HALF, -HALF), scene_between(r, 2.25e-3, 2.45e-3), sizes, 2, 0.5);
}

static dem_status draw_scene(dem_world *w, scene_random *r, int skip, int threads) {
    dem_def def = scene_def(one_of(r, 2) ? 2e-6 : 5e-6);
    def.skip = skip, def.threads = threads;
    def.gravity = one_of(r, 3) ? scene_vector(r, one_of(r, 2) ? 10.0 : 60.0) : dem_vec3(0, 0, 0);
    def.skin = scene_between(r, 0.05, 1.0);
    for (int a = 0; a < 3; a++) def.periodic[a] = one_of(r, 3) == 0;
    def.low = dem_vec3(-HALF, -HALF, -HALF), def.high = dem_vec3(HALF, HALF, HALF);
    dem_status status = dem_init(w, &def, NULL);
    if (status != DEM_OK) return status;
    if (one_of(r, 12) == 0) return draw_crowd(w, r);
    if (one_of(r, 2)) scene_box(w, HALF, -HALF, HALF);
    for (int k = one_of(r, 5); k > 0; k--) draw_wall(w, r);
    return draw_spheres(w, r, 20 + one_of(r, 100));
}

static void draw_links(dem_world *w, scene_random *r, double near) {
    if (dem_set_links(w, &spring_kernel, scene_between(r, 1e-5, 1e-4), near) != DEM_OK) return;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        for (ptrdiff_t j = i > 500 ? i - 500 : 0; j < i; j++) {
            const double state[SPRING_STATES] = {scene_between(r, 0.0, 2.0), 4e-3, scene_between(r, 0.0, 1e-3)};
            const dem_vec d = dem__nearest_image(w, dem__sub(dem_position(w, i), dem_position(w, j)));
            if (dem__length(d) < dem_radius(w, i) + dem_radius(w, j) + 2e-3) dem_add_link(w, i, j, 0, state);
        }
    }
}

/* One of those present: a save leaves out the places of those that are gone. */
static ptrdiff_t draw_sphere(const dem_world *w, scene_random *r) {
    ptrdiff_t present = 0, i = -1;
    for (ptrdiff_t k = 0; k < w->count; k++) present += w->alive[k];
    for (ptrdiff_t nth = one_of(r, (int)present); nth >= 0 && i + 1 < w->count; nth -= w->alive[i]) i++;
    return i;
}

/* What a host does between two runs. */
static void draw_change(dem_world *w, scene_random *r, int *features) {
    const ptrdiff_t i = draw_sphere(w, r);
    const dem_vec v = scene_vector(r, 1.0);
    switch (one_of(r, 9)) {
    case 0: dem_set_motion(w, i, v, dem__scale(50.0, v)); break;
    case 1: dem_remove(w, i); break;
    case 2: dem_set_load(w, i, dem__scale(1e-3, v), dem__scale(1e-6, v)); break;
    case 3: dem_enable_wall(w, one_of(r, 6), one_of(r, 2)); break;
    case 4: draw_wall(w, r); break;
    case 5: draw_spheres(w, r, 10); break;
    case 6: *features ^= DEM_ENERGY; break;
    case 7: draw_motion(w, r, one_of(r, 6)); break;
    default: dem_set_time_step(w, scene_between(r, 1e-6, 4e-6)); break;
    }
}

static void reload(dem_world *w) {
    const size_t size = dem_save(w, NULL, 0);
    unsigned char *buffer = (unsigned char *)malloc(size);
    dem_world copy;
    FUZZ_ASSERT(size > 0 && buffer && dem_save(w, buffer, size) == size);
    FUZZ_ASSERT(dem_load(&copy, buffer, size, NULL) == DEM_OK);
    FUZZ_ASSERT(dem_hash(&copy) == dem_hash(w));
    dem_free(w);
    *w = copy;
    for (int k = 0; k < w->walls; k++) {
        if (w->wall[k].asked.drive == DEM_PRESCRIBED)
            FUZZ_ASSERT(dem_prescribe(w, k, w->wall[k].asked.spin_centre, swing, NULL) == DEM_OK);
    }
    if (w->engine->links.interval > 0.0)
        FUZZ_ASSERT(dem_set_links(w, &spring_kernel, w->engine->links.interval, w->engine->links.near) == DEM_OK);
    free(buffer);
}

/* The hash after each of some runs; as many as the scene lasts. */
enum { RUNS = 4 };
static int hashes_of(uint64_t seed, int skip, int threads, int saves, uint64_t *hash) {
    scene_random r = {seed};
    dem_world w;
    int k = 0, features = one_of(&r, 2) ? DEM_LINEAR : DEM_HERTZ;
    features |= one_of(&r, 2) ? DEM_FRICTION | (one_of(&r, 2) ? DEM_ROLLING : 0) : 0;
    features |= one_of(&r, 3) == 0 ? DEM_ENERGY : 0;
    if (draw_scene(&w, &r, skip, threads) == DEM_OK) {
        if (one_of(&r, 3) == 0) draw_links(&w, &r, one_of(&r, 2) ? 0.0 : 2e-7);
        for (; k < RUNS; k++) {
            const dem_status status = dem_run(
                &w, scene_between(&r, 0.0, w.count - w.engine->bodies.dropped > 1000 ? 0.001 : 0.015), features);
            hash[k] = status == DEM_OK ? dem_hash(&w) : (uint64_t)status;
            if (status != DEM_OK) break;
            draw_change(&w, &r, &features);
            if (saves) reload(&w);
        }
    }
    dem_free(&w);
    return k;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    uint64_t seed = size, hash[2][RUNS + 1];
    for (size_t k = 0; k < size; k++) seed = (seed ^ bytes[k]) * 0x100000001b3u;
    static const struct {
        int skip, threads, saves;
    } other[] = {{0, 1, 0}, {DEM_SKIP_SPACE, 2, 0}, {DEM_SKIP_ALL, 3, 1}};
    const int runs = hashes_of(seed, DEM_SKIP_ALL, 1, 0, hash[0]);
    for (size_t k = 0; k < sizeof other / sizeof *other; k++) {
        FUZZ_ASSERT(hashes_of(seed, other[k].skip, other[k].threads, other[k].saves, hash[1]) == runs);
        for (int m = 0; m < runs; m++) FUZZ_ASSERT(hash[0][m] == hash[1][m]);
    }
    return 0;
}

static const char *const samples[] = {"scene", "another one", "a third"};
FUZZ_MAIN(samples, 3, 25)
