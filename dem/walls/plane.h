/* Planes: half spaces, touched where the sphere is nearest. */
#pragma once
#include "add.h"

static inline int dem__touch_plane(const dem_wall *w, dem_vec d, double radius, double limit, dem__touch *out,
                                   double *least) {
    dem__touch_flat(w, d, radius, out);
    *least = out[0].gap;
    return out[0].gap < limit;
}

/* Returns whether a plane continues unchanged along an axis of the world. */
static inline int dem__is_along_plane(const dem_wall *w, int axis) { return dem_axis(w->axis[2], axis) == 0.0; }

static inline int dem__plane_corners(const dem_wall *w) {
    (void)w;
    return DEM__CORNERS_ALL;
}

static inline const dem__wall_kind *dem__plane(void) {
    static const dem__wall_kind row = {
        DEM_PLANE,                     /* kind */
        DEM__HALF_SPACE | DEM__CONVEX, /* flags */
        NULL,                          /* is_sound */
        dem__touch_plane,              /* touch */
        NULL,                          /* touch_element */
        NULL,                          /* other_elements */
        NULL,                          /* reach_round */
        NULL,                          /* normal_rate */
        dem__is_along_plane,           /* is_endless */
        NULL,                          /* closing */
        dem__plane_corners,            /* corners */
        NULL,                          /* edges */
        NULL                           /* crosses */
    };
    return &row;
}

/* Adds a plane or an exit. */
static inline int dem__add_flat(dem_world *w, const dem__wall_kind *kind, int material, dem_vec point, dem_vec normal) {
    dem_wall wall;
    const dem_status status = dem__may_add_wall(w, material);
    memset(&wall, 0, sizeof wall);
    if (status != DEM_OK) return -(int)status;
    if (!dem__is_place(point)) return -(int)dem__refuse(w, "point: a coordinate is not finite or above 1e150");
    if (!dem__finite_vec(normal) || !dem__frame(&wall, normal, dem_vec3(1, 0, 0)))
        return -(int)dem__refuse(w, "normal: not finite, or of length 0");
    wall.asked.origin = point;
    return dem__add_wall(w, kind, material, &wall);
}

DEM_API int dem_add_plane(dem_world *world, int material, dem_vec point, dem_vec normal) {
    return dem__add_flat(world, dem__plane(), material, point, normal);
}
