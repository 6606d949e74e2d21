/* Cylinders without ends, with particles inside or outside. */
#pragma once
#include "round.h"

/* Returns the part of a vector that is perpendicular to the axis. */
DEM_INLINE dem_vec dem__across_axis(const dem_wall *w, dem_vec d) {
    return dem__plus(d, -dem__dot(d, w->axis[2]), w->axis[2]);
}

static inline int dem__touch_cylinder(const dem_wall *w, dem_vec d, double radius, double limit, dem__touch *out,
                                      double *least) {
    return dem__touch_round(w, dem__across_axis(w, d), 0.5, radius, limit, out, least);
}

static inline double dem__reach_cylinder(const dem_wall *w, dem_vec d, int32_t element, dem_vec *from, double *inner) {
    (void)element;
    return dem__side_of_round(w, dem__across_axis(w, d), from, inner);
}

static inline dem_vec dem__turn_at_cylinder(const dem_wall *w, dem_vec d, double radius, int32_t element, dem_vec n,
                                            double inverse, dem_vec u) {
    (void)d, (void)radius, (void)element;
    return dem__scale(inverse, dem__across_axis(w, dem__sub(u, dem__scale(dem__dot(u, n), n))));
}

static inline int dem__is_along_cylinder(const dem_wall *w, int axis) {
    return fabs(dem_axis(w->axis[2], axis)) == 1.0;
}

/* Motion along the axis does not close the gap. Inside, a straight path at u approaches the surface: the distance from
   the axis grows by no more than the outward velocity and u_side^2 / distance give. */
static inline double dem__closing_at_cylinder(const dem_wall *w, const dem__touch *touch, double radius,
                                              dem_vec gravity, dem_vec u) {
    const double along = dem__dot(gravity, w->axis[2]), from_axis = w->radius - radius - touch->gap;
    const double a = sqrt(fabs(dem__dot(gravity, gravity) - along * along)) + w->side_bound;
    if (!w->inside) return a;
    const double up = dem__dot(u, w->axis[2]);
    return a + (from_axis > 0.0 ? (dem__dot(u, u) - up * up) / from_axis : HUGE_VAL);
}

static inline int dem__cylinder_corners(const dem_wall *w) { return w->inside ? DEM__CORNERS_ALL : DEM__CORNERS_SOME; }

/* Outside, a cylinder is one long edge, as long as edges of a polyhedron can cross it. */
static inline void dem__cylinder_edges(const dem_wall *w, dem_vec centre, double reach, dem__edge_visitor *v) {
    const dem_vec foot = dem__across_axis(w, dem__sub(w->position, centre));
    const double far_off = 4.0 * (reach + w->radius);
    dem__wall_edge e;
    if (w->inside) return;
    memset(&e, 0, sizeof e);
    e.from = dem__plus(foot, -far_off, w->axis[2]), e.to = dem__plus(foot, far_off, w->axis[2]);
    e.radius = w->radius;
    e.key = DEM_CORNERS_MAX;
    v->edge(v, &e);
}

static inline const dem__wall_kind *dem__cylinder(void) {
    static const dem__wall_kind row = {
        DEM_CYLINDER,             /* kind */
        DEM__CONVEX,              /* flags */
        dem__is_round,            /* is_sound */
        dem__touch_cylinder,      /* touch */
        NULL,                     /* touch_element */
        NULL,                     /* other_elements */
        dem__reach_cylinder,      /* reach_round */
        dem__turn_at_cylinder,    /* normal_rate */
        dem__is_along_cylinder,   /* is_endless */
        dem__closing_at_cylinder, /* closing */
        dem__cylinder_corners,    /* corners */
        dem__cylinder_edges,      /* edges */
        NULL                      /* crosses */
    };
    return &row;
}

DEM_API int dem_add_cylinder(dem_world *world, int material, dem_vec point, dem_vec axis, double radius, int inside) {
    return dem__add_round(world, dem__cylinder(), material, point, axis, radius, inside);
}
