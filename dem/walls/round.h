/* What cylinders and spheres share. `radial` is the part of the position that is perpendicular to an axis, or all of
   it. */
#pragma once
#include "add.h"

/* Finds the touch with a surface of constant radius. part: its mean curvature times the radius [-]. */
DEM_INLINE int dem__touch_round(const dem_wall *w, dem_vec radial, double part, double radius, double limit,
                                dem__touch *out, double *least) {
    const double distance = dem__length(radial), side = w->inside ? -1.0 : 1.0;
    *least = out[0].gap = side * (distance - w->radius) - radius;
    if (!(out[0].gap < limit) || !(distance > 0.0)) return 0;
    out[0].normal = dem__scale(side / distance, radial);
    out[0].curvature = part * side / w->radius;
    return 1;
}

/* Returns on which side of a surface of constant radius a sphere is; 0 where there is no normal. */
DEM_INLINE double dem__side_of_round(const dem_wall *w, dem_vec radial, dem_vec *from, double *inner) {
    *from = radial;
    *inner = w->radius;
    return !(dem__dot(radial, radial) > 0.0) ? 0.0 : w->inside ? -1.0 : 1.0;
}

static inline int dem__is_round(const dem_wall *w) { return w->radius > 0.0 && w->radius <= DBL_MAX; }

/* Adds a cylinder or a sphere. */
static inline int dem__add_round(dem_world *w, const dem__wall_kind *kind, int material, dem_vec point, dem_vec axis,
                                 double radius, int inside) {
    dem_wall wall;
    const dem_status status = dem__may_add_wall(w, material);
    memset(&wall, 0, sizeof wall);
    if (status != DEM_OK) return -(int)status;
    if (!dem__is_place(point))
        return -(int)dem__refuse(w, "point or centre: a coordinate is not finite or above 1e150");
    if (!dem__finite_vec(axis) || !dem__frame(&wall, axis, dem_vec3(1, 0, 0)))
        return -(int)dem__refuse(w, "axis: not finite, or of length 0");
    if (!dem__positive(radius)) return -(int)dem__refuse(w, "radius: not a finite number above 0");
    wall.asked.origin = point;
    wall.radius = radius;
    wall.inside = inside != 0;
    return dem__add_wall(w, kind, material, &wall);
}
