/* What every kind of wall computes: where it is touched, how its normal turns, how its surface moves. Pure functions.
 */
#pragma once
#include "mesh_touch.h"

/* Returns whether a wall acts on particles of a group. */
DEM_INLINE int dem__acts_on(const dem_wall *w, int32_t group) {
    return (int)(w->groups >> (group >= 0 && group < 31 ? group : 31) & 1u);
}

DEM_INLINE void dem__touch_plane(const dem_wall *w, dem_vec centre, double radius, dem__touch *out) {
    out->element = 0;
    out->gap = dem__dot(dem__sub(centre, w->position), w->axis[2]) - radius;
    out->normal = w->axis[2], out->curvature = 0.0;
}

/* Finds all places where a sphere's gap to a wall is below limit (at most DEM__TOUCHES; of a mesh the nearest, and
   those that overlap). Returns their number; least: a lower limit of the gap. */
static inline int dem__touch_wall(const dem_wall *w, dem_vec centre, double radius, double limit, dem__touch *out,
                                  double *least) {
    dem_vec d = dem__sub(centre, w->position);
    double up = dem__dot(d, w->axis[2]);
    int n = 0;
    out[0].element = 0;
    out[0].curvature = 0.0;
    if (w->kind == DEM_PLANE || w->kind == DEM_EXIT) {
        dem__touch_plane(w, centre, w->kind == DEM_PLANE ? radius : 0.0, out);
        *least = out[0].gap;
        return out[0].gap < limit;
    }
    if (w->kind == DEM_CYLINDER || w->kind == DEM_SPHERE) {
        const dem_vec radial = w->kind == DEM_SPHERE ? d : dem__plus(d, -up, w->axis[2]);
        const double distance = dem__length(radial), side = w->inside ? -1.0 : 1.0;
        *least = out[0].gap = side * (distance - w->radius) - radius;
        if (!(out[0].gap < limit) || !(distance > 0.0)) return 0;
        out[0].normal = dem__scale(side / distance, radial);
        out[0].curvature = (w->kind == DEM_SPHERE ? side : 0.5 * side) / w->radius;
        return 1;
    }
    if (w->kind == DEM_CONE) return dem__touch_cone(w, d, up, radius, limit, out, least);
    if (w->kind == DEM_MESH) return w->tree->touch(w, d, radius, limit < 0.0 ? limit : 0.0, limit, out, least);
    *least = fabs(up) - radius - 0.5 * w->wire;
    if (!(*least < limit)) return 0;
    double bound = HUGE_VAL;
    for (int family = 0; family < 2; family++) {
        const double along = dem__dot(d, w->axis[family]), across = dem__dot(d, w->axis[1 - family]);
        const double nearest = dem__nearest_bar(w, family, across);
        if (!(fabs(nearest) < 1e6)) continue;
        for (int side = 0; side < 2; side++) {
            if (!dem__touch_bar(w, family, nearest + side, along, across, up, radius, &out[n])) continue;
            bound = out[n].gap < bound ? out[n].gap : bound;
            if (!(out[n].gap < limit)) continue;
            out[n].normal = dem__from_bar(w, family, out[n].normal);
            n++;
        }
    }
    const double third = dem__third_bar(w, radius, bound);
    bound = third < bound ? third : bound;
    *least = bound > *least ? bound : *least;
    return n;
}

/* Finds the one place where an element of a wall is touched, at any gap. */
static inline void dem__touch_element(const dem_wall *w, dem_vec centre, double radius, int32_t element,
                                      dem__touch *out) {
    double least;
    if (w->kind == DEM_SCREEN) {
        const dem_vec d = dem__sub(centre, w->position);
        const int family = (int)((uint32_t)element & 1u);
        const double index = (double)((element - family) / 2);
        out->gap = HUGE_VAL, out->curvature = 0.0, out->normal = w->axis[2];
        if (dem__touch_bar(w, family, index, dem__dot(d, w->axis[family]), dem__dot(d, w->axis[1 - family]),
                           dem__dot(d, w->axis[2]), radius, out))
            out->normal = dem__from_bar(w, family, out->normal);
        return;
    }
    if (w->kind == DEM_PLANE) {
        dem__touch_plane(w, centre, radius, out);
        return;
    }
    dem__touch touch[DEM__TOUCHES]; /* a mesh can be touched in several places */
    touch[0].gap = HUGE_VAL, touch[0].normal = w->axis[2];
    dem__touch_wall(w, centre, radius, HUGE_VAL, touch, &least);
    *out = touch[0];
}

/* Computes the vector from the axis or centre of a wall that is round at an element to a sphere's centre, and how far
   from there the surface is. Returns 1 if the sphere is outside, -1 if inside, 0 if the place is not round or has no
   normal. */
static inline double dem__reach_round(const dem_wall *w, dem_vec centre, int32_t element, dem_vec *from,
                                      double *inner) {
    const dem_vec d = dem__sub(centre, w->position);
    if (w->kind == DEM_SCREEN) {
        const int family = (int)((uint32_t)element & 1u);
        const double along = dem__dot(d, w->axis[family]), across = dem__dot(d, w->axis[1 - family]),
                     up = dem__dot(d, w->axis[2]);
        *inner = dem__reach_bar(w, family, (double)((element - family) / 2), along, across, up, from);
        *from = dem__from_bar(w, family, *from);
        return *inner >= 0.0 && dem__dot(*from, *from) > 0.0 ? 1.0 : 0.0;
    }
    if (w->kind != DEM_CYLINDER && w->kind != DEM_SPHERE) return 0.0;
    *from = w->kind == DEM_SPHERE ? d : dem__plus(d, -dem__dot(d, w->axis[2]), w->axis[2]);
    *inner = w->radius;
    return !(dem__dot(*from, *from) > 0.0) ? 0.0 : w->inside ? -1.0 : 1.0;
}

/* Returns the rate of change of the normal at a cone [1/s]; at a rim it is that of a ring. */
static inline dem_vec dem__normal_rate_of_cone(const dem_wall *w, dem_vec d, double radius, dem_vec n, dem_vec u) {
    const dem_vec radial = dem__plus(d, -dem__dot(d, w->axis[2]), w->axis[2]);
    dem__touch touch;
    double least;
    const double from_axis = dem__length(radial);
    if (!dem__touch_cone(w, d, dem__dot(d, w->axis[2]), radius, HUGE_VAL, &touch, &least) || !(from_axis > 0.0))
        return dem_vec3(0.0, 0.0, 0.0);
    const dem_vec outward = dem__scale(1.0 / from_axis, radial);
    const dem_vec round = dem__cross(w->axis[2], outward);
    const double about = dem__dot(u, round);
    dem_vec rate = dem__scale(dem__dot(n, outward) * about / from_axis, round);
    if (touch.curvature != 0.0) return rate;
    const dem_vec up = dem__sub(u, dem__add(dem__scale(dem__dot(u, n), n), dem__scale(about, round)));
    return dem__plus(rate, 1.0 / (radius + touch.gap), up);
}

/* Returns whether the normal of a wall at rest is the same at all of its places. */
DEM_INLINE int dem__is_flat(const dem_wall *w) {
    return w->kind != DEM_SPHERE && w->kind != DEM_CYLINDER && w->kind != DEM_CONE && w->kind != DEM_SCREEN &&
           w->kind != DEM_MESH;
}

/* Returns the rate of change of the normal n at a place of a wall [1/s] for a sphere that moves at u in the wall's own
   frame. inverse: 1 / distance from the axis of a round wall, with the sign of the side. */
static inline dem_vec dem__normal_rate(const dem_wall *w, dem_vec centre, double radius, int32_t element, dem_vec n,
                                       double inverse, dem_vec u) {
    const dem_vec side = dem__sub(u, dem__scale(dem__dot(u, n), n));
    if (w->kind == DEM_SPHERE) return dem__scale(inverse, side);
    if (w->kind == DEM_CYLINDER) return dem__scale(inverse, dem__plus(side, -dem__dot(side, w->axis[2]), w->axis[2]));
    if (w->kind == DEM_CONE) return dem__normal_rate_of_cone(w, dem__sub(centre, w->position), radius, n, u);
    if (w->kind == DEM_SCREEN) {
        const dem_vec along = w->axis[(uint32_t)element & 1u];
        if (fabs(dem__dot(n, along)) > 1e-9) return dem__scale(inverse, side); /* at a bar's end */
        if (w->profile == DEM_SEMICIRCLE && dem__dot(n, w->axis[2]) <= 1e-12 - 1.0)
            return dem_vec3(0.0, 0.0, 0.0); /* its flat side */
        return dem__scale(inverse, dem__plus(side, -dem__dot(side, along), along));
    }
    return dem_vec3(0.0, 0.0, 0.0);
}

/* Returns the velocity of a wall's surface at a point whose normal is n. */
DEM_INLINE dem_vec dem__surface_velocity(const dem_wall *w, dem_vec point, dem_vec n) {
    const dem_vec turning = dem__cross(dem__scale(w->spin, w->spin_axis), dem__sub(point, w->position));
    return dem__add(dem__add(w->velocity, turning), dem__sub(w->asked.belt, dem__scale(dem__dot(w->asked.belt, n), n)));
}
/* Returns the acceleration of a wall's surface at a point. */
DEM_INLINE dem_vec dem__surface_acceleration(const dem_wall *w, dem_vec point) {
    const dem_vec omega = dem__scale(w->spin, w->spin_axis), arm = dem__sub(point, w->position);
    const dem_vec inward = dem__cross(omega, dem__cross(omega, arm));
    return dem__add(w->acceleration, dem__add(inward, dem__scale(w->spin_rate, dem__cross(w->spin_axis, arm))));
}
