/* Vectors: pure functions. */
#pragma once
#include "api.h"
#include "../../base/portable_math.h"

/* Rounds to multiples of 2e-100, which changes only numbers below 1e-68. Speeds that decay thus end at 0; neither they
   nor their squares become subnormal numbers, which make a processor slow. Two additions cost less than a comparison.
   */
DEM_INLINE double dem__flushed(double v) { return (v + DEM__LEAST) - DEM__LEAST; }
DEM_INLINE dem_vec dem__flushed_vec(dem_vec v) {
    return dem_vec3(dem__flushed(v.x), dem__flushed(v.y), dem__flushed(v.z));
}

DEM_INLINE dem_vec dem__add(dem_vec a, dem_vec b) { return dem_vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
DEM_INLINE dem_vec dem__sub(dem_vec a, dem_vec b) { return dem_vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
DEM_INLINE dem_vec dem__scale(double s, dem_vec a) { return dem_vec3(s * a.x, s * a.y, s * a.z); }
DEM_INLINE dem_vec dem__plus(dem_vec a, double s, dem_vec b) {
    return dem_vec3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
DEM_INLINE double dem__dot(dem_vec a, dem_vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
DEM_INLINE dem_vec dem__cross(dem_vec a, dem_vec b) {
    return dem_vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
DEM_INLINE double dem__length(dem_vec a) { return sqrt(dem__dot(a, a)); }

/* Returns the sine of an angle, and its cosine: the bits of riddle_sin and riddle_cos, which both find the quarter
   turn. */
static DEM__NOINLINE double dem__sine(double angle, double *cosine) {
    int quarter;
    const double r = riddle__within_quarter(angle, &quarter);
    *cosine = riddle__sin_quarter(r, quarter + 1);
    return riddle__sin_quarter(r, quarter);
}

/* Rotates v by an angle [rad] about a unit axis (Rodrigues). */
static DEM__NOINLINE dem_vec dem__rotated(dem_vec v, dem_vec axis, double angle) {
    double turns = angle / (2.0 * RIDDLE_PI), phase = 2.0 * RIDDLE_PI * (turns - floor(turns));
    double c, s = dem__sine(phase, &c);
    return dem__add(dem__add(dem__scale(c, v), dem__scale(s, dem__cross(axis, v))),
                    dem__scale((1.0 - c) * dem__dot(axis, v), axis));
}

DEM_INLINE double dem__clamp(double v, double low, double high) { return v < low ? low : (v > high ? high : v); }
