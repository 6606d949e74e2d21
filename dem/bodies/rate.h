/* How fast a clump answers to its contacts, on which the advice on the time step counts. */
#pragma once
#include "../base/engine.h"
#include "../base/modes.h"

/* Of a radius: what lies no further from a plane counts as touching with the first sphere. */
#define DEM__TOUCHES_TOO 0.1

/* Sets the rate of the contacts of a clump over k/m: of all spheres that a plane across a principal axis touches at
   once, at most 20 % too high, and of each sphere alone, at most twice too high. */
static inline void dem__set_rate(const dem_world *w, dem__rigid *r) {
    const dem_vec *at = w->engine->bodies.offset + r->first;
    const dem_particle *sphere = w->particle + r->first;
    const double agility[3] = {r->mass / r->moments.x, r->mass / r->moments.y, r->mass / r->moments.z};
    r->rate = 1.0;
    for (int side = 0; side < 6; side++) {
        dem_vec normal = dem_vec3(0.0, 0.0, 0.0);
        double top = -HUGE_VAL;
        dem__modes m;
        memset(&m, 0, sizeof m);
        *dem_axis_of(&normal, side / 2) = side % 2 ? -1.0 : 1.0;
        for (ptrdiff_t k = 0; k < r->pieces; k++) {
            const double end = dem__dot(at[k], normal) + sphere[k].radius;
            top = end > top ? end : top;
        }
        for (ptrdiff_t k = 0; k < r->pieces; k++) {
            if (dem__dot(at[k], normal) + sphere[k].radius > top - DEM__TOUCHES_TOO * sphere[k].radius)
                dem__add_spring_at(&m, 1.0, at[k], normal, agility);
        }
        const double together = dem__highest_rate(&m, 3);
        r->rate = together > r->rate ? together : r->rate;
    }
    for (ptrdiff_t k = 0; k < r->pieces; k++) {
        const dem_vec x = at[k];
        const double alone = 1.0 + agility[0] * (x.y * x.y + x.z * x.z) + agility[1] * (x.z * x.z + x.x * x.x) +
                             agility[2] * (x.x * x.x + x.y * x.y);
        r->rate = alone > r->rate ? alone : r->rate;
    }
}
