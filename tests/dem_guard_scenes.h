/* dem_guard_scenes.h: scenes with what those of dem_scenes.h leave out: the ledger's sums, links with a step of
   their own, meshes, driven walls, a feed, a world saved, loaded and run on, polyhedra, and bodies in gas. Each yields
   one number that depends on every bit of the result, readers included. */
#ifndef RIDDLE_DEM_GUARD_SCENES_H
#define RIDDLE_DEM_GUARD_SCENES_H

#include <stdlib.h>

#include "dem_scenes.h"

enum {
    GUARD_LEDGER,
    GUARD_HERTZ_LEDGER,
    GUARD_LINKS,
    GUARD_MESH,
    GUARD_DRIVEN,
    GUARD_FEED,
    GUARD_SAVED,
    GUARD_POLYHEDRA,
    GUARD_BODIES_IN_GAS,
    GUARD_COUNT
};

static inline const char *guard_name(int scene) {
    static const char *const name[] = {"ledger", "hertz ledger", "links",     "mesh",     "driven walls",
                                       "feed",   "saved",        "polyhedra", "body drag"};
    return name[scene];
}

/* ---- numbers of a result ---- */

/* FNV-1a over the bits of a number. */
static inline void guard_mix(uint64_t *hash, double v) {
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    for (int k = 0; k < 8; k++) *hash = (*hash ^ (bits >> (8 * k) & 255u)) * 0x100000001b3u;
}
static inline void guard_mix_vec(uint64_t *hash, dem_vec v) {
    guard_mix(hash, v.x), guard_mix(hash, v.y), guard_mix(hash, v.z);
}

static inline void guard_mix_energy(uint64_t *hash, const dem_world *w) {
    const dem_energy_ledger l = dem_energy(w);
    const double sums[] = {l.kinetic,      l.rotational,   l.elastic,   l.potential,     l.normal_loss,
                           l.sliding_loss, l.rolling_loss, l.wall_work, l.external_work, l.link_work,
                           l.added,        l.removed,      l.error};
    for (size_t k = 0; k < sizeof sums / sizeof *sums; k++) guard_mix(hash, sums[k]);
}

static inline void guard_mix_walls(uint64_t *hash, const dem_world *w) {
    for (int k = 0; k < w->walls; k++) {
        guard_mix_vec(hash, w->wall[k].position), guard_mix_vec(hash, w->wall[k].velocity);
        guard_mix_vec(hash, w->wall[k].force), guard_mix_vec(hash, w->wall[k].torque),
            guard_mix_vec(hash, w->wall[k].impulse);
        guard_mix(hash, w->wall[k].coordinate), guard_mix(hash, w->wall[k].rate);
    }
}

static inline void guard_mix_contacts(uint64_t *hash, const dem_world *w) {
    for (ptrdiff_t k = 0; k < dem_contact_count(w); k++) {
        const dem_contact_info c = dem_get_contact(w, k);
        guard_mix(hash, (double)c.i), guard_mix(hash, (double)c.j), guard_mix(hash, c.gap),
            guard_mix_vec(hash, c.force);
    }
    for (ptrdiff_t k = 0; k < dem_link_count(w); k++) {
        const dem_contact_info c = dem_get_link(w, k);
        guard_mix(hash, (double)c.i), guard_mix(hash, (double)c.j), guard_mix(hash, c.gap),
            guard_mix_vec(hash, c.force);
    }
}

/* Everything that readers tell of a world, now. */
static inline void guard_mix_world(uint64_t *hash, const dem_world *w, int ledger) {
    const uint64_t state = dem_hash(w);
    guard_mix(hash, (double)(state >> 32)), guard_mix(hash, (double)(state & 0xffffffffu));
    for (ptrdiff_t i = 0; i < w->count; i++)
        guard_mix_vec(hash, dem_position(w, i)), guard_mix_vec(hash, dem_velocity(w, i));
    guard_mix_walls(hash, w);
    guard_mix_contacts(hash, w);
    for (ptrdiff_t k = 0; k < w->passed_count; k++) {
        const dem_passed *p = &w->passed[k];
        guard_mix(hash, p->time), guard_mix(hash, (double)p->id), guard_mix(hash, (double)p->exit),
            guard_mix_vec(hash, p->velocity);
    }
    if (ledger) guard_mix_energy(hash, w);
}

/* ---- scenes ---- */

static const dem_law guard_spring = {"spring", 1, SPRING_STATES, 0, 0, 0, NULL, scene_spring_force, NULL, NULL};
DEM_LINK_KERNEL(guard_spring_kernel, guard_spring)

static inline dem_status guard_begin(dem_world *w, double dt, int threads) {
    dem_def def = scene_def(dt);
    def.threads = threads;
    def.gravity = dem_vec3(0, 0, -40); /* so that things happen soon */
    return dem_init(w, &def, NULL);
}

/* A heap in a shaken box with a hole above an exit; some are loaded, some are added, moved and removed in mid-run. */
static inline dem_status guard_ledger(dem_world *w, int threads, int features, uint64_t *hash) {
    scene_random r = {4711};
    const double sizes[2] = {5e-3, 8e-3}, late[6] = {0, 0, 0.06, 0.004, 0.001, 0.07}, wide[2] = {6e-3, 5e-3};
    dem_status status = guard_begin(w, 2e-6, threads);
    if (status != DEM_OK) return status;
    scene_box(w, 0.0275, 0.0, 0.1);
    dem_add_exit(w, dem_vec3(0, 0, 0.0012), dem_vec3(0.3, 0, 1));
    dem_vibrate(w, 4, dem_vec3(3e-4, 0, 5e-4), dem_vec3(0, 0, 1.0), 60.0);
    dem_set_belt(w, 0, dem_vec3(0, 0.2, 0));
    status = scene_fill(w, &r, 6, 6, 4, dem_vec3(-0.026, -0.026, 0.003), 8.6e-3, sizes, 2, 0.4);
    if (status == DEM_OK) status = dem_set_load(w, 5, dem_vec3(1e-3, 0, -2e-3), dem_vec3(0, 2e-6, 0));
    for (int part = 0; part < 4 && status == DEM_OK; part++) {
        status = dem_run(w, 0.005, features);
        guard_mix_world(hash, w, 1);
        if (part == 0 && status == DEM_OK) status = dem_add_spheres(w, 2, late, wide, 0, 9);
        if (part == 1 && status == DEM_OK) status = dem_remove(w, w->count - 3);
        if (part == 2 && status == DEM_OK) status = dem_set_motion(w, 2, dem_vec3(0.1, 0, -0.3), dem_vec3(1, 2, 3));
    }
    return status;
}

/* Damped springs that tear, between spheres and from a sphere to the floor, every tenth step; some of the
   linked touch. */
static inline dem_status guard_links_begin(dem_world *w, int threads, double interval) {
    scene_random r = {99};
    const double one = 5e-3, strong[SPRING_STATES] = {20.0, 1.2e-3, 2e-3}, weak[SPRING_STATES] = {5.0, 3e-4, 1e-3};
    dem_status status = guard_begin(w, 4e-6, threads);
    if (status != DEM_OK) return status;
    scene_box(w, 0.0225, 0.0, 0.1);
    status = dem_set_links(w, &guard_spring_kernel, interval, 1e-6);
    if (status == DEM_OK) status = scene_fill(w, &r, 8, 8, 5, dem_vec3(-0.0208, -0.0208, 0), 5.2e-3, &one, 1, 0.3);
    for (int i = 0; i < 320 && status == DEM_OK; i++) {
        if (i % 8 != 7) status = dem_add_link(w, i, i + 1, 0, i % 3 ? strong : weak);
        if (status == DEM_OK && i < 64 && i % 2) status = dem_add_link(w, i, -1 - 4, 0, strong);
    }
    return status;
}
static inline dem_status guard_links(dem_world *w, int threads, uint64_t *hash) {
    dem_status status = guard_links_begin(w, threads, 4e-5);
    for (int part = 0; part < 3 && status == DEM_OK; part++) {
        status = dem_run(w, 0.003132, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY);
        guard_mix_world(hash, w, 1);
    }
    return status;
}

/* Spheres in a shaken box of triangles, over a cone and a turning block of triangles. */
static inline dem_status guard_mesh_begin(dem_world *w, int threads) {
    scene_random r = {123};
    const double sizes[2] = {5e-3, 3e-3};
    dem_cone cone = dem_default_cone();
    dem_status status = guard_begin(w, 2e-6, threads);
    if (status != DEM_OK) return status;
    const int box = dem_add_box(w, 1, dem_vec3(-0.02, -0.021, 0), dem_vec3(0.02, 0.022, 0.06));
    const int block = dem_add_box(w, 1, dem_vec3(-0.018, -0.004, 0.002), dem_vec3(-0.004, 0.004, 0.012));
    cone.low = dem_vec3(0.008, 0, 0.001), cone.high = dem_vec3(0.008, 0, 0.012), cone.low_radius = 0.008,
    cone.high_radius = 0.002;
    const int hill = dem_add_cone(w, 1, &cone);
    if (box < 0 || block < 0 || hill < 0) return DEM_BAD_ARGUMENT;
    status = dem_vibrate(w, box, dem_vec3(0, 2e-4, 4e-4), dem_vec3(0, 0.5, 0), 80.0);
    if (status == DEM_OK) status = dem_rotate(w, block, dem_vec3(-0.011, 0, 0.007), dem_vec3(0, 0.2, 1), 40.0);
    if (status == DEM_OK) status = scene_fill(w, &r, 6, 6, 5, dem_vec3(-0.0178, -0.0178, 0.013), 5.9e-3, sizes, 2, 0.5);
    return status;
}
static inline dem_status guard_mesh(dem_world *w, int threads, uint64_t *hash) {
    dem_status status = guard_mesh_begin(w, threads);
    for (int part = 0; part < 2 && status == DEM_OK; part++) {
        status = dem_run(w, 0.012, DEM_HERTZ | DEM_FRICTION | DEM_ROLLING);
        guard_mix_world(hash, w, 0);
    }
    return status;
}

static inline void guard_shake(void *user, double time, dem_pose *pose) {
    const double s = riddle_sin(400.0 * time);
    (void)user;
    pose->shift = dem_vec3(3e-4 * s, 0, 0);
    pose->turn = dem_vec3(0, 0.02 * s, 0);
}

/* A heap under a piston, around a rotor, on a prescribed floor, beside a sphere that drifts through it. */
static inline dem_status guard_driven_begin(dem_world *w, int threads) {
    scene_random r = {321};
    const double one = 5e-3;
    dem_status status = guard_begin(w, 4e-6, threads);
    if (status != DEM_OK) return status;
    scene_box(w, 0.022, 0.0, 0.034);
    const int rotor = dem_add_cylinder(w, 1, dem_vec3(0, 0, 0.001), dem_vec3(0, 1, 0), 4e-3, 0);
    const int ball = dem_add_sphere_wall(w, 1, dem_vec3(0.028, 0.012, 0.012), 6e-3, 0);
    status = dem_prescribe(w, 4, dem_vec3(0, 0, 0), guard_shake, NULL);
    if (status == DEM_OK) status = dem_control_force(w, 5, dem_vec3(0, 0, 1), 0.02, -3.0, 0.1);
    if (status == DEM_OK)
        status = dem_control_torque(w, rotor, dem_vec3(0, 0, 0.001), dem_vec3(0, 1, 0), 2e-6, 1e-3, 1e-5);
    if (status == DEM_OK) status = dem_move(w, ball, dem_vec3(-0.3, 0, 0));
    if (status == DEM_OK) status = scene_fill(w, &r, 8, 8, 4, dem_vec3(-0.0216, -0.0216, 0.007), 5.4e-3, &one, 1, 0.3);
    return status;
}
static inline dem_status guard_driven(dem_world *w, int threads, uint64_t *hash) {
    dem_status status = guard_driven_begin(w, threads);
    for (int part = 0; part < 2 && status == DEM_OK; part++) {
        status = dem_run(w, 0.01, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY);
        guard_mix_world(hash, w, 1);
    }
    return status;
}

/* A filled block of three kinds of sizes, then a stream through a disc; some leave by an exit, some are taken
   out by region. */
static inline dem_status guard_feed(dem_world *w, int threads, uint64_t *hash) {
    dem_feed fill = dem_default_feed(), stream = dem_default_feed();
    dem_status status = guard_begin(w, 4e-6, threads);
    if (status != DEM_OK) return status;
    scene_box(w, 0.025, 0.0, 0.2);
    dem_add_exit(w, dem_vec3(0.0245, 0, 0.01), dem_vec3(-1, 0, 0.7));
    const dem_region top = dem_box_region(dem_vec3(-0.03, -0.03, 0.045), dem_vec3(0.03, 0.03, 0.06));
    fill.region = dem_box_region(dem_vec3(-0.025, -0.025, 0.0), dem_vec3(0.025, 0.025, 0.04));
    fill.sizes = dem_lognormal_sizes(4e-3, 0.3, 2e-3, 8e-3, 1);
    fill.scatter = dem_vec3(0.2, 0.2, 0.2);
    stream.region = dem_cylinder_region(dem_vec3(0, 0, 0.05), dem_vec3(0, 0.1, 1), 0.0, 0.02);
    stream.sizes = dem_rosin_rammler_sizes(4e-3, 4.0, 2e-3, 7e-3, 0);
    stream.velocity = dem_vec3(0, 0, -2.0);
    stream.group = 3;
    status = dem_fill_mass(w, &fill, 0.03);
    for (int part = 0; part < 8 && status == DEM_OK; part++) {
        status = dem_feed_mass(w, &stream, 0.4, 0.0025);
        if (status == DEM_OK) status = dem_run(w, 0.0025, DEM_LINEAR | DEM_FRICTION);
        if (status == DEM_OK && part % 4 == 3) guard_mix(hash, (double)dem_remove_region(w, &top));
        guard_mix_world(hash, w, 0);
    }
    guard_mix(hash, fill.placed_mass), guard_mix(hash, stream.placed_mass), guard_mix(hash, stream.due_mass);
    return status;
}

/* Saves the world and goes on with what was loaded. */
static inline dem_status guard_reload(dem_world *w) {
    const size_t size = dem_save(w, NULL, 0);
    unsigned char *bytes = (unsigned char *)malloc(size);
    dem_world loaded;
    memset(&loaded, 0, sizeof loaded);
    dem_status status = bytes ? DEM_OK : DEM_OUT_OF_MEMORY;
    if (status == DEM_OK && dem_save(w, bytes, size) != size) status = DEM_BAD_DATA;
    if (status == DEM_OK) status = dem_load(&loaded, bytes, size, NULL);
    if (status == DEM_OK && dem_hash(&loaded) != dem_hash(w)) status = DEM_BAD_DATA;
    free(bytes);
    dem_free(w);
    *w = loaded;
    return status;
}

/* The scenes above with links, meshes and driven walls, saved and loaded after an odd number of steps, then run on;
   without saving the same number results. */
static inline dem_status guard_saved(dem_world *w, int threads, int saves, uint64_t *hash) {
    dem_status status = DEM_OK;
    for (int scene = 0; scene < 3 && status == DEM_OK; scene++) {
        const int features = scene == 1 ? DEM_HERTZ | DEM_FRICTION | DEM_ROLLING : DEM_LINEAR | DEM_FRICTION;
        if (scene > 0) dem_free(w);
        status = scene == 0   ? guard_links_begin(w, threads, 4e-5)
                 : scene == 1 ? guard_mesh_begin(w, threads)
                              : guard_driven_begin(w, threads);
        for (int part = 0; part < 3 && status == DEM_OK; part++) {
            status = dem_run(w, 1013.0 * w->def.dt, features);
            if (status == DEM_OK && saves) status = guard_reload(w);
            if (status == DEM_OK && scene == 0) status = dem_set_links(w, &guard_spring_kernel, 4e-5, 1e-6);
            if (status == DEM_OK && scene == 2) status = dem_prescribe(w, 4, dem_vec3(0, 0, 0), guard_shake, NULL);
        }
        if (status == DEM_OK) status = dem_run(w, 611.0 * w->def.dt, features);
        guard_mix_world(hash, w, 0);
    }
    return status;
}

/* Adds a brick, gravel, a tablet and the hull of a cloud of points to a world. Returns whether that works. */
static inline int guard_add_shapes(dem_world *w, scene_random *r, double size) {
    dem_convex shape[4];
    double point[120];
    for (int k = 0; k < 120; k++) point[k] = scene_between(r, -0.5 * size, 0.5 * size);
    if (dem_make_brick(&shape[0], dem_vec3(size, 0.8 * size, 0.6 * size), 0.1, NULL) != DEM_OK) return 0;
    if (dem_make_gravel(&shape[1], size, 0.8, 0.7, 14, 5, 0.1, NULL) != DEM_OK) return 0;
    if (dem_make_tablet(&shape[2], size, 0.5 * size, 0.5 * size, 0.1, NULL) != DEM_OK) return 0;
    if (dem_make_hull(&shape[3], 40, point, 0.1, 0.0, NULL, NULL) != DEM_OK) return 0;
    for (int k = 0; k < 4; k++)
        if (dem_add_shape(w, &shape[k]) != k) return 0;
    return 1;
}

/* Adds n polyhedra of these shapes, turned at random, that fly and spin; every fifth is a pair of spheres. */
static inline dem_status guard_add_bodies(dem_world *w, scene_random *r, int n, int row, dem_vec corner, double pitch,
                                          double size, double speed) {
    const double ends[6] = {0, 0, -0.4, 0, 0, 0.4}, two[2] = {1.0, 0.7};
    dem_clump pair;
    dem_status status = dem_make_clump(2, ends, two, &pair);
    for (int k = 0; k < n && status == DEM_OK; k++) {
        const double at[3] = {corner.x + pitch * (k % row + 0.5), corner.y + pitch * (k / row % row + 0.5),
                              corner.z + pitch * (k / row / row + 0.5)};
        double turn[4];
        for (int q = 0; q < 4; q++) turn[q] = scene_between(r, -1.0, 1.0);
        status = k % 5 == 4 ? dem_add_clumps(w, 1, &pair, at, &size, turn, 0, 0)
                            : dem_add_convex(w, k % 5, 1, at, turn, 0, 0);
        const dem_vec v = scene_vector(r, speed), spin = scene_vector(r, 50.0 * speed);
        if (status == DEM_OK) status = dem_set_motion(w, w->count - 1, v, spin);
    }
    return status;
}

/* Orientations and contacts as readers tell them. */
static inline void guard_mix_bodies(uint64_t *hash, const dem_world *w) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_quaternion q = dem_orientation(w, i);
        guard_mix(hash, q.w), guard_mix(hash, q.x), guard_mix(hash, q.y), guard_mix(hash, q.z);
    }
    for (ptrdiff_t k = 0; k < dem_contact_count(w); k++) {
        const dem_contact_info c = dem_get_contact(w, k);
        guard_mix_vec(hash, c.point), guard_mix_vec(hash, c.normal);
    }
    guard_mix(hash, (double)dem_core_overlap_steps(w));
}

/* Bricks, gravel, tablets, hulls and pairs of spheres fall on a plane and a turning block of triangles, and on each
   other; the world is saved and loaded half-way. */
static inline dem_status guard_polyhedra(dem_world *w, int threads, uint64_t *hash) {
    scene_random r = {61};
    dem_status status = guard_begin(w, 2e-6, threads);
    if (status != DEM_OK) return status;
    scene_box(w, 0.016, 0.0, 0.1);
    const int block = dem_add_box(w, 1, dem_vec3(-0.008, -0.003, -0.002), dem_vec3(0.008, 0.003, 0.005));
    if (block < 0 || !guard_add_shapes(w, &r, 5e-3)) return DEM_BAD_ARGUMENT;
    status = dem_rotate(w, block, dem_vec3(0, 0, 0.001), dem_vec3(0, 0.1, 1), 20.0);
    if (status == DEM_OK) status = guard_add_bodies(w, &r, 60, 4, dem_vec3(-0.015, -0.015, 0.0055), 7.5e-3, 5e-3, 0.4);
    for (int part = 0; part < 2 && status == DEM_OK; part++) {
        status = dem_run(w, 0.02, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY);
        guard_mix_world(hash, w, 1), guard_mix_bodies(hash, w);
        if (part == 0 && status == DEM_OK) status = guard_reload(w);
    }
    return status;
}

DEM_GAS(guard_drag, dem_drag_hoelzer_sommerfeld)

/* Small bodies tumble in a gas that streams past, each with the drag of its own shape, and hit a plane. */
static inline dem_status guard_bodies_in_gas(dem_world *w, int threads, uint64_t *hash) {
    scene_random r = {62};
    dem_gas air = dem_default_gas();
    dem_status status = guard_begin(w, 1e-6, threads);
    if (status != DEM_OK) return status;
    air.drift = dem_vec3(2.0, 0, -4.0);
    const dem_force_field field = dem_gas_field(guard_drag, &air);
    dem_add_plane(w, 1, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
    if (!guard_add_shapes(w, &r, 4e-4)) return DEM_BAD_ARGUMENT;
    status = guard_add_bodies(w, &r, 20, 3, dem_vec3(0, 0, 2e-4), 7e-4, 4e-4, 1.0);
    if (status == DEM_OK) status = dem_set_force_field(w, &field);
    for (int part = 0; part < 2 && status == DEM_OK; part++) {
        status = dem_run(w, 0.006, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY);
        guard_mix_world(hash, w, 1), guard_mix_bodies(hash, w);
    }
    return status;
}

/* Runs a scene; *hash becomes its number. */
static inline dem_status guard_run(int scene, int threads, uint64_t *hash) {
    dem_world w;
    dem_status status;
    memset(&w, 0, sizeof w);
    *hash = 0xcbf29ce484222325u;
    switch (scene) {
    case GUARD_LEDGER:
        status = guard_ledger(&w, threads, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY, hash);
        break;
    case GUARD_HERTZ_LEDGER:
        status = guard_ledger(&w, threads, DEM_HERTZ | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY, hash);
        break;
    case GUARD_LINKS: status = guard_links(&w, threads, hash); break;
    case GUARD_MESH: status = guard_mesh(&w, threads, hash); break;
    case GUARD_DRIVEN: status = guard_driven(&w, threads, hash); break;
    case GUARD_FEED: status = guard_feed(&w, threads, hash); break;
    case GUARD_SAVED: status = guard_saved(&w, threads, 1, hash); break;
    case GUARD_POLYHEDRA: status = guard_polyhedra(&w, threads, hash); break;
    default: status = guard_bodies_in_gas(&w, threads, hash); break;
    }
    dem_free(&w);
    return status;
}

#endif
