/* dem_bad_calls.h: calls that a world refuses with DEM_BAD_ARGUMENT, one argument at a time. */
#ifndef RIDDLE_DEM_BAD_CALLS_H
#define RIDDLE_DEM_BAD_CALLS_H
#include "dem_guard_scenes.h"

/* A world with one material, a plane (wall 0), an open mesh of one triangle (wall 1), a sphere (0), a dumbbell (1, 2),
   a fixed dumbbell (3, 4), a shape and a gap (5). */
typedef struct bad_calls {
    dem_world world;
    dem_feed feed;
    dem_clump clump;
    dem_convex shape;
    dem_compound compound;
    double share;
} bad_calls;

static double bad_triangle[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
static int32_t bad_corner[3] = {0, 1, 2}, bad_point[3] = {1, 1, 1};

static inline int bad_calls_begin(bad_calls *b) {
    dem_def def = dem_default_def();
    const double ends[6] = {0, 0, 0, 1e-3, 0, 0}, two[2] = {2e-3, 2e-3}, at[3] = {0.5, 0.5, 0.5};
    double more[3] = {0.5, 0.6, 0.5};
    dem_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.vertices = 3, mesh.vertex = bad_triangle, mesh.triangles = 1, mesh.triangle = bad_corner;
    memset(b, 0, sizeof *b);
    dem_add_material(&def, 2500.0, 1e9, 0.25);
    b->feed = dem_default_feed(), b->share = 1.0;
    if (dem_init(&b->world, &def, NULL) || dem_make_clump(2, ends, two, &b->clump)) return 0;
    if (dem_make_brick(&b->shape, dem_vec3(2e-3, 2e-3, 3e-3), 0.05, NULL)) return 0;
    if (dem_add_plane(&b->world, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) != 0) return 0;
    if (dem_add_mesh(&b->world, 0, &mesh) != 1 || dem_add_spheres(&b->world, 1, at, two, 0, 0)) return 0;
    for (int k = 0; k < 2; k++, more[1] += 0.1) {
        if (dem_add_clumps(&b->world, 1, &b->clump, more, NULL, NULL, 0, 0)) return 0;
    }
    if (dem_fix(&b->world, 3, 1) || dem_add_spheres(&b->world, 1, more, two, 0, 0)) return 0;
    return dem_remove(&b->world, 5) == DEM_OK && dem_add_shape(&b->world, &b->shape) == 0;
}

/* Each function makes bad call k of its group, tells a word that the text must have, and returns minus the status; 0:
   there are no more. */
static inline int bad_wall(bad_calls *b, int k, const char **argument) {
    dem_world *w = &b->world;
    const dem_vec o = dem_vec3(0, 0, 0), z = dem_vec3(0, 0, 1), none = dem_vec3((double)NAN, 0, 0);
    dem_screen screen = dem_default_screen();
    dem_cone cone = dem_default_cone();
    dem_disc disc = dem_default_disc();
    dem_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.vertices = 3, mesh.vertex = bad_triangle, mesh.triangles = 1, mesh.triangle = bad_corner;
    switch (k) {
    case 0: return *argument = "material", dem_add_plane(w, 1, o, z);
    case 1: return *argument = "point", dem_add_plane(w, 0, none, z);
    case 2: return *argument = "normal", dem_add_plane(w, 0, o, o);
    case 3: return *argument = "radius", dem_add_cylinder(w, 0, o, z, 0.0, 1);
    case 4: return *argument = "axis", dem_add_cylinder(w, 0, o, none, 1.0, 1);
    case 5: return *argument = "centre", dem_add_sphere_wall(w, 0, none, 1.0, 1);
    case 6: return *argument = "wire", screen.wire = 0.0, dem_add_screen(w, 0, &screen);
    case 7: return *argument = "half_y", screen.circular = 0, screen.half_y = -1.0, dem_add_screen(w, 0, &screen);
    case 8: return *argument = "screen.normal", screen.normal = o, dem_add_screen(w, 0, &screen);
    case 9: return *argument = "cone.high", cone.high = cone.low, dem_add_cone(w, 0, &cone);
    case 10: return *argument = "low_radius", cone.low_radius = -1.0, dem_add_cone(w, 0, &cone);
    case 11: return *argument = "disc.radius", disc.hole_radius = 1.0, dem_add_disc(w, 0, &disc);
    case 12: return *argument = "disc.centre", disc.centre = none, dem_add_disc(w, 0, &disc);
    case 13: return *argument = "index", mesh.vertices = 2, dem_add_mesh(w, 0, &mesh);
    case 14: return *argument = "area", mesh.triangle = bad_point, dem_add_mesh(w, 0, &mesh);
    case 15: return *argument = "low", dem_add_box(w, 0, z, o);
    case 16: return *argument = "finite", dem_add_box(w, 0, o, dem_vec3(HUGE_VAL, 1, 1));
    case 17: return *argument = "normal", dem_add_exit(w, o, o);
    case 18: return *argument = "neither a mesh", -(int)dem_set_solid(w, 0, 1);
    case 19: return *argument = "closed", -(int)dem_set_solid(w, 1, 1);
    default: return 0;
    }
}

static inline int bad_motion_of_wall(bad_calls *b, int k, const char **argument) {
    dem_world *w = &b->world;
    const dem_vec o = dem_vec3(0, 0, 0), z = dem_vec3(0, 0, 1), none = dem_vec3((double)NAN, 0, 0);
    const double big = 1e81;
    switch (k) {
    case 0: return *argument = "wall", -(int)dem_vibrate(w, 2, z, o, 1.0);
    case 1: return *argument = "amplitude", -(int)dem_vibrate(w, 0, none, o, 1.0);
    case 2: return *argument = "phase", -(int)dem_vibrate(w, 0, z, none, 1.0);
    case 3: return *argument = "frequency", -(int)dem_vibrate(w, 0, z, o, -1.0);
    case 4: return *argument = "velocity", -(int)dem_move(w, 0, dem_vec3(big, 0, 0));
    case 5: return *argument = "axis", -(int)dem_rotate(w, 0, o, o, 1.0);
    case 6: return *argument = "spin", -(int)dem_rotate(w, 0, o, z, (double)NAN);
    case 7: return *argument = "centre", -(int)dem_rotate(w, 0, none, z, 1.0);
    case 8: return *argument = "motion", -(int)dem_prescribe(w, 0, o, NULL, NULL);
    case 9: return *argument = "mass", -(int)dem_control_force(w, 0, z, 0.0, 1.0, 0.0);
    case 10: return *argument = "force", -(int)dem_control_force(w, 0, z, 1.0, (double)NAN, 0.0);
    case 11: return *argument = "inertia", -(int)dem_control_torque(w, 0, o, z, -1.0, 1.0, 0.0);
    case 12: return *argument = "torque", -(int)dem_control_torque(w, 0, o, z, 1.0, big, 0.0);
    case 13: return *argument = "damping", -(int)dem_control_torque(w, 0, o, z, 1.0, 1.0, -1.0);
    case 14: return *argument = "velocity", -(int)dem_set_belt(w, 0, none);
    case 15: return *argument = "speed", -(int)dem_turn_belt(w, 0, z, (double)NAN);
    case 16: return *argument = "wall", -(int)dem_set_wall_groups(w, -1, 1u);
    case 17: return *argument = "wall", -(int)dem_enable_wall(w, 7, 0);
    default: return 0;
    }
}

static inline int bad_body(bad_calls *b, int k, const char **argument) {
    dem_world *w = &b->world;
    const dem_vec o = dem_vec3(0, 0, 0), none = dem_vec3((double)NAN, 0, 0);
    const dem_quaternion turn = {0, 0, 0, 0}, unit = {1, 0, 0, 0};
    const double at[3] = {0, 0, 0}, off[3] = {0, (double)NAN, 0}, one = 1e-3, zero = 0.0, still[4] = {0, 0, 0, 0};
    switch (k) {
    case 0: return *argument = "diameters", -(int)dem_add_spheres(w, 1, at, &zero, 0, 0);
    case 1: return *argument = "centres", -(int)dem_add_spheres(w, 1, off, &one, 0, 0);
    case 2: return *argument = "material", -(int)dem_add_spheres(w, 1, at, &one, -1, 0);
    case 3: return *argument = "n:", -(int)dem_add_spheres(w, -1, at, &one, 0, 0);
    case 4: return *argument = "clump", -(int)dem_add_clumps(w, 1, NULL, at, NULL, NULL, 0, 0);
    case 5: return *argument = "orientations", -(int)dem_add_clumps(w, 1, &b->clump, at, NULL, still, 0, 0);
    case 6: return *argument = "centres", -(int)dem_add_clumps(w, 1, &b->clump, off, NULL, NULL, 0, 0);
    case 7: return *argument = "shape", -(int)dem_add_convex(w, 1, 1, at, NULL, 0, 0);
    case 8: return *argument = "orientations", -(int)dem_add_convex(w, 0, 1, at, still, 0, 0);
    case 9: return *argument = "shape", dem_add_shape(w, NULL);
    case 10: return *argument = "parts", -(int)dem_make_compound(w, 1, NULL, NULL, NULL, &b->compound, NULL);
    case 11: return *argument = "place", -(int)dem_make_compound(w, 1, &b->shape, off, NULL, &b->compound, NULL);
    case 12: return *argument = "compound", -(int)dem_add_compounds(w, 1, &b->compound, at, NULL, 0, 0);
    case 13: return *argument = "i:", -(int)dem_set_motion(w, 5, o, o);
    case 14: return *argument = "velocity", -(int)dem_set_motion(w, 0, none, o);
    case 15: return *argument = "spin", -(int)dem_set_motion(w, 0, o, none);
    case 16: return *argument = "fixed body", -(int)dem_set_motion(w, 3, o, dem_vec3(1, 0, 0));
    case 17: return *argument = "force", -(int)dem_set_load(w, 0, none, o);
    case 18: return *argument = "torque", -(int)dem_set_load(w, 0, o, none);
    case 19: return *argument = "orientation", -(int)dem_set_orientation(w, 1, turn);
    case 20: return *argument = "single sphere", -(int)dem_set_orientation(w, 0, unit);
    case 21: return *argument = "fixed", -(int)dem_fix(w, 0, 2);
    case 22: return *argument = "i:", -(int)dem_remove(w, 99);
    default: return 0;
    }
}

static inline int bad_feed(bad_calls *b, int k, const char **argument) {
    dem_world *w = &b->world;
    dem_feed f = b->feed;
    dem_source s;
    memset(&s, 0, sizeof s);
    s.feed = &f, s.share = &b->share, s.classes = 1;
    switch (k) {
    case 0: return *argument = "count", -(int)dem_fill(w, &f, -1);
    case 1: return *argument = "feed: NULL", -(int)dem_fill(w, NULL, 1);
    case 2: return *argument = "tries", f.tries = 0, -(int)dem_fill(w, &f, 1);
    case 3: return *argument = "sizes", f.sizes.diameter[0] = 0.0, -(int)dem_fill(w, &f, 1);
    case 4: return *argument = "region", f.region.low.x = (double)NAN, -(int)dem_fill(w, &f, 1);
    case 5: return *argument = "polyhedron", f.polyhedron = 2, -(int)dem_fill(w, &f, 1);
    case 6: return *argument = "scatter", f.scatter.x = -1.0, -(int)dem_fill(w, &f, 1);
    case 7: return *argument = "due", f.due = HUGE_VAL, -(int)dem_fill(w, &f, 1);
    case 8: return *argument = "mass:", -(int)dem_fill_mass(w, &f, -1.0);
    case 9: return *argument = "rate", -(int)dem_feed_number(w, &f, -1.0, 1.0);
    case 10: return *argument = "mass_flow", -(int)dem_feed_mass(w, &f, (double)NAN, 1.0);
    case 11: return *argument = "duration", -(int)dem_feed_mass(w, &f, 1.0, -1.0);
    case 12: return *argument = "classes", s.classes = 0, -(int)dem_fill_source(w, &s, 1);
    case 13: return *argument = "mass:", -(int)dem_fill_source_mass(w, &s, HUGE_VAL);
    case 14: return *argument = "material", f.material = 1, -(int)dem_feed_source(w, &s, 1.0, 1.0);
    case 15: return *argument = "duration", -(int)dem_feed_source_mass(w, &s, 1e200, 1e200);
    default: return 0;
    }
}

static inline int bad_setting(bad_calls *b, int k, const char **argument) {
    dem_world *w = &b->world;
    dem_pair_def pair = *dem_pair(&w->def, 0, 0);
    dem_force_field field = dem_default_force_field(NULL, NULL);
    switch (k) {
    case 0: return *argument = "dt", -(int)dem_set_time_step(w, 0.0);
    case 1: return *argument = "gravity", -(int)dem_set_gravity(w, dem_vec3((double)NAN, 0, 0));
    case 2: return *argument = "b:", -(int)dem_set_pair(w, 0, 1, &pair);
    case 3: return *argument = "pair.friction: ", pair.friction = -1.0, -(int)dem_set_pair(w, 0, 0, &pair);
    case 4: return *argument = "pair.restitution: ", pair.restitution = 2.0, -(int)dem_set_pair(w, 0, 0, &pair);
    case 5: return *argument = "pair.mode: ", pair.mode = (dem_restitution)7, -(int)dem_set_pair(w, 0, 0, &pair);
    case 6: return *argument = "kernel", -(int)dem_set_links(w, NULL, 1.0, 0.0);
    case 7: return *argument = "interval", -(int)dem_set_links(w, &guard_spring_kernel, 0.0, 0.0);
    case 8: return *argument = "dem_set_links", -(int)dem_add_link(w, 0, 1, 0, NULL);
    case 9: return *argument = "kernel", -(int)dem_set_force_field(w, &field);
    case 10: return *argument = "features", -(int)dem_run(w, 1.0, DEM_LINEAR | DEM_HERTZ);
    case 11: return *argument = "duration", -(int)dem_run(w, -1.0, DEM_LINEAR);
    case 12: return *argument = "steps", -(int)dem_run(w, 1e300, DEM_LINEAR);
    case 13: return *argument = "kernel", -(int)dem_run_law(w, 1.0, NULL);
    case 14: return *argument = "capacity", (int)dem_take_passed(w, NULL, -1);
    case 15: return *argument = "region", (int)dem_remove_region(w, NULL);
    default: return 0;
    }
}
#endif
