/* Adding walls of every kind but meshes. */
#pragma once
#include "../base/definition.h"

static inline int dem__unit(dem_vec v, dem_vec *unit) {
    double length = dem__length(v);
    if (!(length >= 1e-140 && length <= DBL_MAX)) return 0; /* squares of shorter lengths lose digits */
    *unit = dem__scale(1.0 / length, v);
    return 1;
}

/* Completes a frame whose third axis is given. The first axis is near `along`, or any if that is parallel to the third.
   Returns 0 if the third has no direction. */
static inline int dem__frame(dem_wall *wall, dem_vec normal, dem_vec along) {
    dem_vec z, x;
    if (!dem__unit(normal, &z)) return 0;
    x = dem__sub(along, dem__scale(dem__dot(along, z), z));
    if (!(dem__length(x) > 1e-6)) {
        dem_vec other = fabs(z.x) < 0.9 ? dem_vec3(1, 0, 0) : dem_vec3(0, 1, 0);
        x = dem__sub(other, dem__scale(dem__dot(other, z), z));
    }
    if (!dem__unit(x, &x)) return 0;
    wall->axis[0] = wall->asked.rest_axis[0] = x;
    wall->axis[1] = wall->asked.rest_axis[1] = dem__cross(z, x);
    wall->axis[2] = wall->asked.rest_axis[2] = z;
    return 1;
}

/* Adds a wall at rest. Returns its index, or minus a dem_status. */
static inline int dem__add_wall(dem_world *w, const dem_wall *wall) {
    if (w->walls >= DEM_WALLS_MAX) return -(int)DEM_TOO_MANY;
    if (!dem__grow_walls(w, w->walls + 1)) return -(int)DEM_OUT_OF_MEMORY;
    w->wall[w->walls] = *wall;
    w->wall[w->walls].enabled = 1;
    w->wall[w->walls].groups = 0xffffffffu;
    w->wall[w->walls].position = wall->asked.origin;
    w->wall[w->walls].asked.motion_start = w->time;
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    return w->walls++;
}

static inline int dem__add_flat(dem_world *w, int kind, int material, dem_vec point, dem_vec normal) {
    if (dem__is_running(w)) return -(int)DEM_BUSY;
    dem_wall wall;
    memset(&wall, 0, sizeof wall);
    if (!w || material < 0 || material >= w->def.materials || !dem__is_place(point) || !dem__finite_vec(normal))
        return -(int)DEM_BAD_ARGUMENT;
    if (!dem__frame(&wall, normal, dem_vec3(1, 0, 0))) return -(int)DEM_BAD_ARGUMENT;
    wall.kind = kind;
    wall.material = material;
    wall.asked.origin = point;
    return dem__add_wall(w, &wall);
}

DEM_API int dem_add_plane(dem_world *world, int material, dem_vec point, dem_vec normal) {
    return dem__add_flat(world, DEM_PLANE, material, point, normal);
}
DEM_API int dem_add_exit(dem_world *world, dem_vec point, dem_vec normal) {
    return dem__add_flat(world, DEM_EXIT, 0, point, normal);
}

static inline int dem__add_round(dem_world *w, int kind, int material, dem_vec point, dem_vec axis, double radius,
                                 int inside) {
    if (dem__is_running(w)) return -(int)DEM_BUSY;
    dem_wall wall;
    memset(&wall, 0, sizeof wall);
    if (!w || material < 0 || material >= w->def.materials || !dem__is_place(point) || !dem__finite_vec(axis) ||
        !dem__positive(radius))
        return -(int)DEM_BAD_ARGUMENT;
    if (!dem__frame(&wall, axis, dem_vec3(1, 0, 0))) return -(int)DEM_BAD_ARGUMENT;
    wall.kind = kind;
    wall.material = material;
    wall.asked.origin = point;
    wall.radius = radius;
    wall.inside = inside != 0;
    return dem__add_wall(w, &wall);
}

DEM_API int dem_add_cylinder(dem_world *world, int material, dem_vec point, dem_vec axis, double radius, int inside) {
    return dem__add_round(world, DEM_CYLINDER, material, point, axis, radius, inside);
}
DEM_API int dem_add_sphere_wall(dem_world *world, int material, dem_vec centre, double radius, int inside) {
    return dem__add_round(world, DEM_SPHERE, material, centre, dem_vec3(0, 0, 1), radius, inside);
}

/* Makes room for what contacts with meshes and cones keep. Returns 0 when out of memory. */
static inline int dem__make_touch_memory(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__array list[DEM__ARRAYS_MAX];
    if (w->engine->walls.touch_keepers++ > 0 || contacts->capacity == 0) return 1;
    if (dem__grow_group(w, list, dem__contact_arrays(w, list), &contacts->block, &contacts->bytes, &contacts->capacity,
                        contacts->capacity))
        return 1;
    w->engine->walls.touch_keepers--;
    return 0;
}

DEM_API dem_cone dem_default_cone(void) {
    dem_cone c;
    c.low = dem_vec3(0, 0, 0);
    c.high = dem_vec3(0, 0, 0.1);
    c.low_radius = 0.02;
    c.high_radius = 0.1;
    return c;
}

DEM_API int dem_add_cone(dem_world *world, int material, const dem_cone *cone) {
    if (dem__is_running(world)) return -(int)DEM_BUSY;
    dem_wall wall;
    memset(&wall, 0, sizeof wall);
    if (!world || !world->def.allocator.fn || !cone || material < 0 || material >= world->def.materials ||
        !dem__is_place(cone->low) || !dem__is_place(cone->high))
        return -(int)DEM_BAD_ARGUMENT;
    const dem_vec axis = dem__sub(cone->high, cone->low);
    if (!dem__not_negative(cone->low_radius) || !dem__not_negative(cone->high_radius) ||
        !dem__positive(cone->low_radius + cone->high_radius) || !dem__frame(&wall, axis, dem_vec3(1, 0, 0)))
        return -(int)DEM_BAD_ARGUMENT;
    wall.kind = DEM_CONE;
    wall.material = material;
    wall.asked.origin = cone->low;
    wall.radius = cone->low_radius;
    wall.high_radius = cone->high_radius;
    wall.length = dem__length(axis);
    return dem__make_touch_memory(world) ? dem__add_wall(world, &wall) : -(int)DEM_OUT_OF_MEMORY;
}

DEM_API dem_screen dem_default_screen(void) {
    dem_screen s;
    memset(&s, 0, sizeof s);
    s.aperture = 8e-3;
    s.wire = 2e-3;
    s.profile = DEM_SEMICIRCLE;
    s.circular = 1;
    s.half_x = s.half_y = 0.095;
    s.normal = dem_vec3(0, 0, 1);
    s.direction = dem_vec3(1, 0, 0);
    return s;
}

/* Returns whether a screen has lengths, and no more bars and apertures than integers count. */
static inline int dem__is_deck(const dem_wall *w) {
    const double pitch = w->aperture + w->wire, x = w->half_x / pitch, y = w->half_y / pitch;
    return dem__positive(w->aperture) && dem__positive(w->wire) && x > 0.0 && y > 0.0 && x < 1e5 && y < 1e5 &&
           x * y < 2.5e8;
}

DEM_API int dem_add_screen(dem_world *world, int material, const dem_screen *screen) {
    if (dem__is_running(world)) return -(int)DEM_BUSY;
    dem_wall wall;
    memset(&wall, 0, sizeof wall);
    if (!world || !screen || material < 0 || material >= world->def.materials || !dem__is_place(screen->centre) ||
        !dem__finite_vec(screen->normal) || !dem__finite_vec(screen->direction))
        return -(int)DEM_BAD_ARGUMENT;
    if (screen->profile != DEM_ROUND && screen->profile != DEM_SEMICIRCLE) return -(int)DEM_BAD_ARGUMENT;
    if (!dem__frame(&wall, screen->normal, screen->direction)) return -(int)DEM_BAD_ARGUMENT;
    wall.kind = DEM_SCREEN;
    wall.material = material;
    wall.asked.origin = screen->centre;
    wall.aperture = screen->aperture;
    wall.wire = screen->wire;
    wall.profile = (int)screen->profile;
    wall.circular = screen->circular != 0;
    wall.half_x = screen->half_x;
    wall.half_y = screen->circular ? screen->half_x : screen->half_y;
    if (!dem__is_deck(&wall)) return -(int)DEM_BAD_ARGUMENT;
    return dem__add_wall(world, &wall);
}
