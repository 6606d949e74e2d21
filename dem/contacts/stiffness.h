/* Advice on the stiffness: how deep bodies penetrate each other at a speed, and how stiff contacts must be for it. */
#pragma once
#include "laws.h"
#include "../motion/motion.h"
#include "../walls/kind.h"

#define DEM__DEEP_SPHERE 0.1 /* overlap of a sphere, over its radius, that counts as deep */

/* Returns the overlap from which on a contact of particle i counts as deep [m]. */
DEM_INLINE double dem__deep_overlap(const dem_world *w, ptrdiff_t i) {
    const dem_convex *s = dem__shape_of(w, i);
    return s ? s->radius : DEM__DEEP_SPHERE * w->particle[i].radius;
}

/* Returns the overlap at which particle i comes to rest if its whole mass hits something of a material [m]. */
static inline double dem__overlap_at(const dem_world *w, ptrdiff_t i, int material, int features, double speed) {
    const int m = w->material[i];
    double constants[DEM_CONSTANTS_MAX];
    dem_birth b;
    memset(&b, 0, sizeof b);
    b.def = &w->def, b.features = features, b.material_i = m, b.material_j = material;
    b.pair = m < material ? &w->def.pair[m][material] : &w->def.pair[material][m];
    const double springs = dem__springs_of(w, i);
    b.radius_i = dem__touching_radius(w, i), b.mass = w->particle[i].mass;
    if (!(features & DEM_HERTZ)) return speed * sqrt(springs * b.mass / b.pair->stiffness);
    dem_prepare_hertz(&b, constants);
    return speed / 2.943275175395 *
           dem_hertz_contact_time(0.75 * constants[DEM__HERTZ_K] / springs, constants[DEM__HERTZ_RADIUS], b.mass,
                                  speed);
}

/* Sets the advised stiffness, and how deep bodies penetrate with the present one. A pair of bodies has less mass and
   more rounding, so it needs no more stiffness than the more demanding of the two. */
static inline void dem__advise_stiffness(const dem_world *w, int features, double speed, dem_advice *a) {
    int present[DEM_MATERIALS_MAX] = {0};
    a->stiffness = a->depth = 0.0;
    if (!(speed > 0.0)) return;
    for (ptrdiff_t i = 0; i < w->count; i++) present[w->material[i]] |= w->alive[i] != 0;
    for (int k = 0; k < w->walls; k++) present[w->wall[k].material] |= dem__has_surface(&w->wall[k]);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const double deep = dem__deep_overlap(w, i),
                     needed = dem__springs_of(w, i) * w->particle[i].mass * (speed / deep) * (speed / deep);
        if (!w->alive[i] || dem__is_fixed(w, i)) continue;
        a->stiffness = needed > a->stiffness ? needed : a->stiffness;
        for (int m = 0; m < w->def.materials; m++) {
            const double depth = present[m] ? dem__overlap_at(w, i, m, features, speed) / deep : 0.0;
            a->depth = depth > a->depth ? depth : a->depth;
        }
    }
}
