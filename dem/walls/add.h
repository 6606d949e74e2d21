/* What the functions that add walls share. */
#pragma once
#include "../base/definition.h"
#include "kind.h"

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

/* Returns DEM_OK if a wall of a material can be added. */
static inline dem_status dem__may_add_wall(dem_world *w, int material) {
    if (dem__is_running(w)) return DEM_BUSY;
    return dem__lacks_material(w, material) ? DEM_BAD_ARGUMENT : DEM_OK;
}

/* Adds a wall of a kind, at rest at asked.origin. Returns its index, or minus a dem_status. */
static inline int dem__add_wall(dem_world *w, const dem__wall_kind *kind, int material, const dem_wall *shape) {
    if (w->walls >= DEM_WALLS_MAX) return -(int)DEM_TOO_MANY;
    if (!dem__grow_walls(w, w->walls + 1)) return -(int)DEM_OUT_OF_MEMORY;
    if ((kind->flags & (DEM__KEEPS_CURVATURE | DEM__TRIANGULATED)) && !dem__make_touch_memory(w))
        return -(int)DEM_OUT_OF_MEMORY;
    dem_wall *a = &w->wall[w->walls];
    *a = *shape;
    a->kind = kind->kind, a->kind__ = kind;
    a->material = material;
    a->enabled = 1;
    a->groups = 0xffffffffu;
    a->position = a->asked.origin;
    a->asked.motion_start = w->time;
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    return w->walls++;
}
