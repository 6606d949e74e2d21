/* Vectors: pure functions. */
#pragma once
#include "api.h"
#include "../../base/portable_math.h"

/* Rounds to multiples of 2e-100, which changes only numbers below 1e-68. Speeds that decay thus end at 0. Neither
   they nor their squares become subnormal numbers, which slow a processor down. Two additions cost less than a
   comparison. */
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

DEM_INLINE double dem__clamp(double v, double low, double high) { return v < low ? low : (v > high ? high : v); }
DEM_INLINE dem_vec dem__point(const double *x) { return dem_vec3(x[0], x[1], x[2]); }
