/* dem_changes.h: all calls that change a world. From a hook of a world that runs each must be refused. */
#ifndef RIDDLE_DEM_CHANGES_H
#define RIDDLE_DEM_CHANGES_H

#include <string.h>

#include "dem.h"

static inline void stand_still(void *user, double time, dem_pose *pose) { (void)user, (void)time, (void)pose; }

/* Calls every function that changes a world, but those that hooks may call. Returns the number of the first that is not
   refused, or -1. */
static inline int dem_first_accepted(dem_world *w, const dem_kernel *hook_law, const dem_link_kernel *hook_links) {
    const double at[3] = {0.0, 0.0, 0.0}, d = 1e-3;
    dem_region all = dem_sphere_region(dem_vec3(0, 0, 0), 1.0);
    const dem_vec none = dem_vec3(0, 0, 0), up = dem_vec3(0, 0, 1);
    const dem_quaternion as_it_is = {1, 0, 0, 0};
    dem_feed feed = dem_default_feed();
    dem_cone cone = dem_default_cone();
    dem_screen screen = dem_default_screen();
    double vertex[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    int32_t triangle[3] = {0, 1, 2};
    dem_mesh mesh;
    dem_clump clump;
    dem_convex shape;
    memset(&mesh, 0, sizeof mesh);
    mesh.vertices = 3, mesh.triangles = 1, mesh.vertex = vertex, mesh.triangle = triangle;
    if (dem_make_clump(1, at, &d, &clump) != DEM_OK || dem_make_brick(&shape, dem_vec3(d, d, d), 0.1, NULL) != DEM_OK)
        return 1000;
    const dem_status refused[] = {dem_add_spheres(w, 1, at, &d, 0, 0),
                                  dem_add_clumps(w, 1, &clump, at, NULL, NULL, 0, 0),
                                  dem_add_convex(w, 0, 1, at, NULL, 0, 0),
                                  dem_set_orientation(w, 0, as_it_is),
                                  dem_fix(w, 0, 1),
                                  dem_set_force_field(w, NULL),
                                  dem_set_solid(w, 0, 0),
                                  dem_set_wall_groups(w, 0, 1u),
                                  dem_set_links(w, hook_links, 1e-5, 0.0),
                                  dem_rotate(w, 0, none, up, 0.0),
                                  dem_prescribe(w, 0, none, stand_still, NULL),
                                  dem_control_force(w, 0, up, 1.0, 0.0, 0.0),
                                  dem_control_torque(w, 0, none, up, 1.0, 0.0, 0.0),
                                  dem_fill_mass(w, &feed, 1.0),
                                  dem_feed_number(w, &feed, 1.0, 1.0),
                                  dem_feed_mass(w, &feed, 1.0, 1.0),
                                  dem_run_law(w, 1e-5, hook_law),
                                  (dem_status)-dem_add_shape(w, &shape),
                                  (dem_status)-dem_add_cylinder(w, 0, none, up, 1.0, 1),
                                  (dem_status)-dem_add_sphere_wall(w, 0, none, 1.0, 1),
                                  (dem_status)-dem_add_cone(w, 0, &cone),
                                  (dem_status)-dem_add_screen(w, 0, &screen),
                                  (dem_status)-dem_add_mesh(w, 0, &mesh),
                                  (dem_status)-dem_add_exit(w, none, up),
                                  dem_set_motion(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 0)),
                                  dem_set_load(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 0)),
                                  dem_remove(w, 0),
                                  dem_set_gravity(w, dem_vec3(0, 0, 0)),
                                  dem_set_time_step(w, 1e-6),
                                  dem_set_pair(w, 0, 0, dem_pair(&w->def, 0, 0)),
                                  dem_vibrate(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 0), 0.0),
                                  dem_move(w, 0, dem_vec3(0, 0, 0)),
                                  dem_set_belt(w, 0, dem_vec3(0, 0, 0)),
                                  dem_enable_wall(w, 0, 1),
                                  dem_fill(w, &feed, 1),
                                  dem_run(w, 1e-5, DEM_LINEAR),
                                  (dem_status)-dem_add_box(w, 0, dem_vec3(0, 0, 0), dem_vec3(1, 1, 1)),
                                  (dem_status)-dem_add_plane(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)),
                                  (dem_status)-dem_take_passed(w, NULL, 1),
                                  (dem_status)-dem_remove_region(w, &all)};
    dem_free(w); /* does nothing */
    for (size_t k = 0; k < sizeof refused / sizeof *refused; k++) {
        if (refused[k] != DEM_BUSY) return (int)k;
    }
    return -1;
}

#endif
