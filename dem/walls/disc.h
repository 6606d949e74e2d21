/* Discs: flat and thin, with or without a round hole in the middle. A disc is touched from both sides and at its rims.
   */
#pragma once
#include "sheet.h"

/* Finds the touch. The nearest point lies in the plane of axis and centre, at the distance `at` from the axis. */
static inline int dem__touch_disc(const dem_wall *w, dem_vec d, double radius, double limit, dem__touch *out,
                                  double *least) {
    const double up = dem__dot(d, w->axis[2]);
    const dem_vec radial = dem__plus(d, -up, w->axis[2]);
    const double rho = dem__length(radial), at = dem__clamp(rho, w->radius, w->high_radius), beyond = rho - at;
    const double distance = beyond == 0.0 ? fabs(up) : sqrt(beyond * beyond + up * up);
    *least = out[0].gap = distance - radius;
    if (!(*least < limit)) return 0;
    out[0].normal = dem__scale(up < 0.0 ? -1.0 : 1.0, w->axis[2]);
    if (beyond == 0.0) return 1;
    /* on the axis a whole ring is nearest: any point of it will do */
    const dem_vec outward = rho > 0.0 ? dem__scale(1.0 / rho, radial) : w->axis[0];
    out[0].normal = dem__add(dem__scale(beyond / distance, outward), dem__scale(up / distance, w->axis[2]));
    return 1;
}

/* Returns the rate of change of the normal [1/s]: 0 at a face; at a rim, that of a ring. */
static inline dem_vec dem__turn_at_disc(const dem_wall *w, dem_vec d, double radius, int32_t element, dem_vec n,
                                        double inverse, dem_vec u) {
    const dem_vec radial = dem__plus(d, -dem__dot(d, w->axis[2]), w->axis[2]);
    const double rho = dem__length(radial);
    dem__touch touch;
    double least;
    (void)element, (void)inverse;
    if (rho >= w->radius && rho <= w->high_radius) return dem_vec3(0.0, 0.0, 0.0);
    dem__touch_disc(w, d, radius, HUGE_VAL, &touch, &least);
    return dem__turn_about_axis(w, radial, radius + touch.gap, n, u);
}

static inline int dem__is_disc(const dem_wall *w) {
    return dem__not_negative(w->radius) && dem__positive(w->high_radius) && w->radius < w->high_radius;
}

/* Returns whether the line from p to q passes through the disc. */
static inline int dem__crosses_disc(const dem_wall *w, dem_vec p, dem_vec q) {
    const double from = dem__dot(p, w->axis[2]), to = dem__dot(q, w->axis[2]);
    if (!(from * to < 0.0)) return 0;
    const double rho = dem__length(dem__plus(p, from / (from - to), dem__sub(q, p)));
    return rho >= w->radius && rho <= w->high_radius;
}

/* Presents points of the rims to a visitor. */
static inline void dem__disc_edges(const dem_wall *w, dem_vec centre, double reach, dem__edge_visitor *v) {
    const dem_vec middle = dem__sub(w->position, centre);
    const int32_t key = DEM_CORNERS_MAX + DEM__SEARCH_KEYS;
    dem__show_rim(w, middle, w->high_radius, reach, key, v);
    if (w->radius > 0.0) dem__show_rim(w, middle, w->radius, reach, key + DEM__RIM_POINTS, v);
}

static inline const dem__wall_kind *dem__disc(void) {
    static const dem__wall_kind row = {
        DEM_DISC,          /* kind */
        DEM__CURVED_SHEET, /* flags */
        dem__is_disc,      /* is_sound */
        dem__touch_disc,   /* touch */
        NULL,              /* touch_element */
        NULL,              /* other_elements */
        NULL,              /* reach_round */
        dem__turn_at_disc, /* normal_rate */
        NULL,              /* is_endless */
        NULL,              /* closing */
        NULL,              /* corners */
        dem__disc_edges,   /* edges */
        dem__crosses_disc  /* crosses */
    };
    return &row;
}

DEM_API dem_disc dem_default_disc(void) {
    dem_disc d;
    d.centre = dem_vec3(0, 0, 0);
    d.normal = dem_vec3(0, 0, 1);
    d.radius = 0.1;
    d.hole_radius = 0.0;
    return d;
}

DEM_API int dem_add_disc(dem_world *world, int material, const dem_disc *disc) {
    dem_wall wall;
    const dem_status status = dem__may_add_wall(world, material);
    memset(&wall, 0, sizeof wall);
    if (status != DEM_OK) return -(int)status;
    if (!disc) return -(int)dem__refuse(world, "disc: NULL");
    if (!dem__is_place(disc->centre))
        return -(int)dem__refuse(world, "disc.centre: a coordinate is not finite or above 1e150");
    if (!dem__finite_vec(disc->normal) || !dem__frame(&wall, disc->normal, dem_vec3(1, 0, 0)))
        return -(int)dem__refuse(world, "disc.normal: not finite, or of length 0");
    wall.asked.origin = disc->centre;
    wall.radius = disc->hole_radius;
    wall.high_radius = disc->radius;
    if (!dem__is_disc(&wall))
        return -(int)dem__refuse(world, "disc.radius: not finite, or not above hole_radius, which is 0 or more");
    return dem__add_wall(world, dem__disc(), material, &wall);
}
