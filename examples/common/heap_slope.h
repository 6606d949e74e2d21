/* heap_slope.h: the slope of a heap about a vertical line: the highest centre in each ring and sector, and a line
   through the means of the rings between a sixth of the radius and the rim. */
#ifndef RIDDLE_HEAP_SLOPE_H
#define RIDDLE_HEAP_SLOPE_H

#include <math.h>

#include "dem.h"

enum { HEAP_RINGS = 6, HEAP_SECTORS = 12 };

typedef struct heap_slope {
    double angle; /* [rad]; NaN: fewer than 3 rings */
    double radius[HEAP_RINGS],
        height[HEAP_RINGS]; /* of rings, and mean of their highest centres [m]; NaN where hardly any sector has one */
    int rings;              /* that the line has */
    int spheres;            /* within the foot */
    double speed;           /* the largest of them [m/s] */
} heap_slope;

/* Of the particles within `radius` about a line through `centre` along `up` (a unit vector), from the centre's height
   to below `ceiling`. */
static inline heap_slope heap_slope_of(const dem_world *w, dem_vec centre, dem_vec up, double radius, double ceiling) {
    heap_slope h;
    double top[HEAP_RINGS][HEAP_SECTORS], n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    const dem_vec aside = fabs(up.x) < 0.9 ? dem_vec3(1, 0, 0) : dem_vec3(0, 1, 0);
    const double along = aside.x * up.x + aside.y * up.y + aside.z * up.z;
    dem_vec right = dem_vec3(aside.x - along * up.x, aside.y - along * up.y, aside.z - along * up.z);
    const double length = sqrt(right.x * right.x + right.y * right.y + right.z * right.z);
    right = dem_vec3(right.x / length, right.y / length, right.z / length);
    const dem_vec ahead =
        dem_vec3(up.y * right.z - up.z * right.y, up.z * right.x - up.x * right.z, up.x * right.y - up.y * right.x);
    memset(&h, 0, sizeof h);
    h.angle = (double)NAN;
    for (int k = 0; k < HEAP_RINGS * HEAP_SECTORS; k++) top[k / HEAP_SECTORS][k % HEAP_SECTORS] = (double)NAN;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        const dem_vec p = dem_position(w, i), d = dem_vec3(p.x - centre.x, p.y - centre.y, p.z - centre.z),
                      v = dem_velocity(w, i);
        const double a = d.x * right.x + d.y * right.y + d.z * right.z,
                     b = d.x * ahead.x + d.y * ahead.y + d.z * ahead.z, height = d.x * up.x + d.y * up.y + d.z * up.z,
                     out = hypot(a, b);
        if (!(out < radius && height >= 0.0 && height < ceiling)) continue;
        const int ring = (int)(HEAP_RINGS * out / radius),
                  sector = (int)((0.5 + 0.5 * atan2(b, a) / RIDDLE_PI) * HEAP_SECTORS) % HEAP_SECTORS;
        if (!(height <= top[ring][sector])) top[ring][sector] = height;
        h.spheres++, h.speed = fmax(h.speed, sqrt(v.x * v.x + v.y * v.y + v.z * v.z));
    }
    for (int k = 0; k < HEAP_RINGS; k++) {
        int filled = 0;
        double sum = 0.0;
        for (int s = 0; s < HEAP_SECTORS; s++)
            if (top[k][s] == top[k][s]) sum += top[k][s], filled++;
        h.radius[k] = (k + 0.5) * radius / HEAP_RINGS;
        h.height[k] = 2 * filled >= (k == 0 ? 2 : HEAP_SECTORS) ? sum / filled : (double)NAN;
        if (k == 0 || !(h.height[k] == h.height[k])) continue; /* the tip is round */
        const double r = h.radius[k], z = h.height[k];
        n += 1.0, x += r, y += z, xx += r * r, xy += r * z;
    }
    if (n >= 3.0) h.angle = -atan((xy - x * y / n) / (xx - x * x / n));
    h.rings = (int)n;
    return h;
}

#endif
