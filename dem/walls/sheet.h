/* What thin sheets share: their circular rims. */
#pragma once
#include "add.h"
#include "kinematics.h"

enum { DEM__RIM_POINTS = 16 }; /* points of a rim at which faces of polyhedra can touch it */

/* Returns the rate of change of the normal n [1/s] where a surface or a rim goes around the axis axis[2]. radial:
   the part of the position that is perpendicular to it; distance: from the rim to the sphere's centre; 0: not at a
   rim [m]. */
static inline dem_vec dem__turn_about_axis(const dem_wall *w, dem_vec radial, double distance, dem_vec n, dem_vec u) {
    const double from_axis = dem__length(radial);
    if (!(from_axis > 0.0)) return dem_vec3(0.0, 0.0, 0.0);
    const dem_vec outward = dem__scale(1.0 / from_axis, radial);
    const dem_vec round = dem__cross(w->axis[2], outward);
    const double about = dem__dot(u, round);
    const dem_vec rate = dem__scale(dem__dot(n, outward) * about / from_axis, round);
    if (distance == 0.0) return rate;
    const dem_vec up = dem__sub(u, dem__add(dem__scale(dem__dot(u, n), n), dem__scale(about, round)));
    return dem__plus(rate, 1.0 / distance, up);
}

/* Presents points of a rim as sharp corners. middle: its centre. */
static inline void dem__show_rim(const dem_wall *w, dem_vec middle, double radius, double reach, int32_t key,
                                 dem__edge_visitor *v) {
    if (!(dem__length(middle) < radius + reach)) return;
    for (int k = 0; k < (radius > 0.0 ? DEM__RIM_POINTS : 1); k++) {
        const dem_vec out = dem__rotated(w->axis[0], w->axis[2], 2.0 * RIDDLE_PI / (double)DEM__RIM_POINTS * (double)k);
        v->corner(v, dem__plus(middle, radius, out), 0.0, dem_vec3(0.0, 0.0, 0.0), key + k);
    }
}
