/* Polyhedra by a few lengths: tablets, lenses, cylinders, gravel. */
#pragma once
#include "../feed/sizes.h"
#include "make.h"

enum { DEM__TABLET_SIDES = 16, DEM__GRAVEL_MAX = 300 };

/* Adds a ring of n points about the z axis, turned by `share` of the angle between two points. Returns the new number
   of points. */
static inline int dem__add_ring(double (*x)[3], int at, int n, double radius, double height, double share) {
    for (int k = 0; k < n; k++) {
        const double angle = 2.0 * RIDDLE_PI * ((double)k + share) / (double)n;
        x[at + k][0] = radius * riddle_cos(angle), x[at + k][1] = radius * riddle_sin(angle), x[at + k][2] = height;
    }
    return at + n;
}

/* Makes a hull of n points and scales it to a volume. flat: along x and y alone. */
static inline dem_status dem__make_of_volume(dem_convex *shape, int n, double (*x)[3], double volume, int flat,
                                             double rounding, const char **reason) {
    dem_status status = dem_make_hull(shape, n, x[0], rounding, 0.0, NULL, reason);
    if (status != DEM_OK) return status;
    const double factor = flat ? sqrt(volume / shape->volume) : riddle_cbrt(volume / shape->volume);
    for (int k = 0; k < (flat ? 2 : 3) * n; k++) x[flat ? k / 2 : k / 3][flat ? k % 2 : k % 3] *= factor;
    return dem_make_hull(shape, n, x[0], rounding, 0.0, NULL, reason);
}

DEM_API dem_status dem_make_tablet(dem_convex *shape, double diameter, double height, double band, double rounding,
                                   const char **reason) {
    double x[10 * DEM__TABLET_SIDES][3];
    const double cap = 0.5 * (height - band), r = 0.5 * diameter;
    const char *wrong = !dem__positive(diameter) || !dem__positive(height) ? "a length is not a number above 0"
                        : !(band >= 0.0 && band <= height)                 ? "the band is not 0 .. the height"
                        : !(cap <= r)                                      ? "a cap is higher than a half ball"
                                                                           : NULL;
    if (reason) *reason = wrong;
    if (wrong) return DEM_BAD_ARGUMENT;
    const int sides = DEM__TABLET_SIDES, is_flat = !(cap > 1e-6 * diameter);
    const double volume = RIDDLE_PI * (r * r * band + cap / 3.0 * (3.0 * r * r + cap * cap));
    int n = dem__add_ring(x, 0, sides, r, 0.5 * (is_flat ? height : band), 0.0);
    if (is_flat || band > 1e-3 * height) n = dem__add_ring(x, n, sides, r, -0.5 * (is_flat ? height : band), 0.0);
    for (int k = 0; k < 12 && !is_flat; k++) { /* rings and a pole on each cap of a ball */
        static const int of_ring[6] = {16, 16, 12, 8, 5, 1};
        static const double place[6] = {0.95, 0.8, 0.6, 0.4, 0.2, 0.0};
        const double ball = 0.5 * (r * r + cap * cap) / cap, at = r * place[k % 6],
                     up = sqrt(ball * ball - at * at) - (ball - cap);
        n = dem__add_ring(x, n, of_ring[k % 6], at, (k < 6 ? 1.0 : -1.0) * (0.5 * band + up), 0.5 * k);
    }
    return dem__make_of_volume(shape, n, x, volume, is_flat, rounding, reason);
}

DEM_API dem_status dem_make_gravel(dem_convex *shape, double diameter, double elongation, double flatness, int corners,
                                   uint64_t seed, double rounding, const char **reason) {
    double x[DEM__GRAVEL_MAX][3];
    const char *wrong = !dem__positive(diameter)                    ? "the diameter is not a number above 0"
                        : corners < 6 || corners > DEM__GRAVEL_MAX  ? "the number of corners is not 6 .. 300"
                        : !(elongation >= 0.1 && elongation <= 1.0) ? "the elongation is not 0.1 .. 1"
                        : !(flatness >= 0.1 && flatness <= 1.0)     ? "the flatness is not 0.1 .. 1"
                                                                    : NULL;
    if (reason) *reason = wrong;
    if (wrong) return DEM_BAD_ARGUMENT;
    const double jitter = 1.8 / sqrt((double)corners), axis[3] = {1.0, elongation, elongation * flatness};
    uint64_t random = seed;
    for (int k = 0; k < corners; k++) { /* a spiral over the ball, perturbed */
        const double up = 1.0 - (2.0 * (double)k + 1.0) / (double)corners, across = sqrt(1.0 - up * up);
        const double angle = 2.0 * RIDDLE_PI * (0.618033988749895 * (double)k - floor(0.618033988749895 * (double)k));
        dem_vec v = dem_vec3(up, across * riddle_cos(angle), across * riddle_sin(angle));
        v.x += jitter * (dem__uniform(&random) - 0.5), v.y += jitter * (dem__uniform(&random) - 0.5);
        v.z += jitter * (dem__uniform(&random) - 0.5);
        v = dem__scale(0.5 * diameter / dem__length(v), v);
        for (int a = 0; a < 3; a++) x[k][a] = axis[a] * dem_axis(v, a);
    }
    return dem__make_of_volume(shape, corners, x, RIDDLE_PI / 6.0 * diameter * diameter * diameter, 0, rounding,
                               reason);
}
