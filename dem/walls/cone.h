/* Cones: frustums and tubes of finite length, as thin sheets. A sheet is touched from both sides and at its rims. */
#pragma once
#include "sheet.h"

/* Computes the touch with a frustum. Its nearest point lies in the plane of axis and centre, on a segment. d: the
   centre, from the low end. Returns 0 if the gap is not below `limit`. least: the gap. */
static inline int dem__touch_cone(const dem_wall *w, dem_vec d, double radius, double limit, dem__touch *out,
                                  double *least) {
    const double up = dem__dot(d, w->axis[2]);
    const dem_vec radial = dem__sub(d, dem__scale(up, w->axis[2]));
    const double rho = dem__length(radial), rise = w->high_radius - w->radius,
                 slant = sqrt(rise * rise + w->length * w->length);
    /* on the axis a whole ring is nearest: any point of it will do */
    const dem_vec outward = rho > 0.0 ? dem__scale(1.0 / rho, radial) : w->axis[0];
    const double along = dem__clamp(((rho - w->radius) * rise + up * w->length) / (slant * slant), 0.0, 1.0);
    const double x = rho - (w->radius + along * rise), y = up - along * w->length;
    double distance = sqrt(x * x + y * y), nx = w->length / slant, ny = -rise / slant;
    const int on_rim = !(along > 0.0 && along < 1.0);
    if (!on_rim) { /* from the side's own normal, which is accurate near the surface */
        const double side = (rho - w->radius) * nx + up * ny;
        distance = fabs(side);
        if (side < 0.0) nx = -nx, ny = -ny;
    } else if (distance > 0.0) nx = x / distance, ny = y / distance;
    *least = out[0].gap = distance - radius;
    if (!(*least < limit)) return 0;
    out[0].normal = dem__add(dem__scale(nx, outward), dem__scale(ny, w->axis[2]));
    /* the curvature half way up, so that there is one contact type wherever a contact begins; spheres wider than the
       ring lie on a rim */
    out[0].curvature = on_rim ? 0.0 : (nx < 0.0 ? -1.0 : 1.0) * w->length / (slant * (w->radius + w->high_radius));
    return 1;
}

/* Returns the rate of change of the normal [1/s]; at a rim, that of a ring. */
static inline dem_vec dem__turn_at_cone(const dem_wall *w, dem_vec d, double radius, int32_t element, dem_vec n,
                                        double inverse, dem_vec u) {
    dem__touch touch;
    double least;
    (void)element, (void)inverse;
    if (!dem__touch_cone(w, d, radius, HUGE_VAL, &touch, &least)) return dem_vec3(0.0, 0.0, 0.0);
    const dem_vec radial = dem__plus(d, -dem__dot(d, w->axis[2]), w->axis[2]);
    return dem__turn_about_axis(w, radial, touch.curvature != 0.0 ? 0.0 : radius + touch.gap, n, u);
}

static inline int dem__is_cone(const dem_wall *w) {
    return dem__positive(w->length) && dem__not_negative(w->radius) && dem__not_negative(w->high_radius) &&
           dem__positive(w->radius + w->high_radius);
}

/* Returns whether the line from p to q passes through the sheet. */
static inline int dem__crosses_cone(const dem_wall *w, dem_vec p, dem_vec q) {
    const dem_vec u = dem__sub(q, p);
    const double slope = (w->high_radius - w->radius) / w->length, z = dem__dot(p, w->axis[2]),
                 along = dem__dot(u, w->axis[2]);
    const double r = w->radius + slope * z, dr = slope * along; /* radius of the cone at p, and its change to q */
    const double a = dem__dot(u, u) - along * along - dr * dr, b = dem__dot(p, u) - z * along - r * dr;
    const double c = dem__dot(p, p) - z * z - r * r, root = sqrt(b * b > a * c ? b * b - a * c : 0.0);
    const double t[2] = {b > 0.0 ? c / (-b - root) : (root - b) / a, b > 0.0 ? (-b - root) / a : c / (root - b)};
    if (b * b < a * c) return 0;
    for (int k = 0; k < 2; k++) {
        if (t[k] >= 0.0 && t[k] <= 1.0 && z + t[k] * along >= 0.0 && z + t[k] * along <= w->length &&
            r + t[k] * dr >= 0.0)
            return 1;
    }
    return 0;
}

/* Presents points of both rims to a visitor. */
static inline void dem__cone_edges(const dem_wall *w, dem_vec centre, double reach, dem__edge_visitor *v) {
    const dem_vec low = dem__sub(w->position, centre);
    dem__show_rim(w, low, w->radius, reach, DEM_CORNERS_MAX + DEM__SEARCH_KEYS, v);
    dem__show_rim(w, dem__plus(low, w->length, w->axis[2]), w->high_radius, reach,
                  DEM_CORNERS_MAX + DEM__SEARCH_KEYS + DEM__RIM_POINTS, v);
}

static inline const dem__wall_kind *dem__cone(void) {
    static const dem__wall_kind row = {
        DEM_CONE,                                 /* kind */
        DEM__KEEPS_CURVATURE | DEM__CURVED_SHEET, /* flags */
        dem__is_cone,                             /* is_sound */
        dem__touch_cone,                          /* touch */
        NULL,                                     /* touch_element */
        NULL,                                     /* other_elements */
        NULL,                                     /* reach_round */
        dem__turn_at_cone,                        /* normal_rate */
        NULL,                                     /* is_endless */
        NULL,                                     /* closing */
        NULL,                                     /* corners */
        dem__cone_edges,                          /* edges */
        dem__crosses_cone                         /* crosses */
    };
    return &row;
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
    dem_wall wall;
    const dem_status status = dem__may_add_wall(world, material);
    memset(&wall, 0, sizeof wall);
    if (status != DEM_OK) return -(int)status;
    if (!cone) return -(int)dem__refuse(world, "cone: NULL");
    if (!dem__is_place(cone->low))
        return -(int)dem__refuse(world, "cone.low: a coordinate is not finite or above 1e150");
    if (!dem__is_place(cone->high))
        return -(int)dem__refuse(world, "cone.high: a coordinate is not finite or above 1e150");
    const dem_vec axis = dem__sub(cone->high, cone->low);
    wall.asked.origin = cone->low;
    wall.radius = cone->low_radius;
    wall.high_radius = cone->high_radius;
    wall.length = dem__length(axis);
    if (!dem__frame(&wall, axis, dem_vec3(1, 0, 0)))
        return -(int)dem__refuse(world, "cone.high: at the same place as low");
    if (!dem__is_cone(&wall))
        return -(int)dem__refuse(world, "cone.low_radius, high_radius: one is below 0 or not finite, or both are 0");
    return dem__add_wall(world, dem__cone(), material, &wall);
}
