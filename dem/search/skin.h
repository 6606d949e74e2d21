/* The frame and the skin of the list of near pairs, which determine how long it lasts. Reads bodies; writes these
   fields of pairs. */
#pragma once
#include "bounds.h"

/* Returns the length of the periodic box along an axis; HUGE_VAL where it is not periodic. */
DEM_INLINE double dem__period(const dem_world *w, int axis) {
    return w->def.periodic[axis] ? dem_axis(w->def.high, axis) - dem_axis(w->def.low, axis) : HUGE_VAL;
}
static inline double dem__narrowest(const dem_world *w) {
    double narrowest = HUGE_VAL;
    for (int a = 0; a < 3; a++) narrowest = dem__period(w, a) < narrowest ? dem__period(w, a) : narrowest;
    return narrowest;
}

/* Chooses the frame in which the list measures how far particles have moved. It moves at their mean velocity, and falls
   with them if most are in flight, so that the list lasts long. */
static inline void dem__choose_frame(dem_world *w) {
    dem__pairs *pairs = &w->engine->pairs;
    const int flies = 2 * w->engine->bodies.active_count < w->count;
    dem_vec sum = dem_vec3(0.0, 0.0, 0.0);
    double n = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i]) sum = dem__add(sum, dem__velocity_at(w, i, dem__now(w, i))), n += 1.0;
    }
    pairs->gravity_size = dem__length(dem__free_fall(w));
    pairs->frame_velocity = n > 0.0 ? dem__scale(1.0 / n, sum) : sum;
    pairs->frame_acceleration = flies ? dem__free_fall(w) : dem_vec3(0.0, 0.0, 0.0);
    pairs->frame_fall = flies ? 0.0 : pairs->gravity_size;
}

/* Records the positions of all particles, and finds the smallest and the largest radius [m]. Returns 0 if a position is
   not finite. */
static inline int dem__list_positions(dem_world *w, double *smallest, double *largest) {
    *smallest = HUGE_VAL, *largest = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        const dem_vec x = dem__in_box(w, dem__at(w, i, dem__now(w, i)));
        w->engine->pairs.listed_at[i] = x;
        *smallest = w->particle[i].radius < *smallest ? w->particle[i].radius : *smallest;
        *largest = w->particle[i].radius > *largest ? w->particle[i].radius : *largest;
        if (!(fabs(x.x) < 1e100 && fabs(x.y) < 1e100 && fabs(x.z) < 1e100)) {
            w->status = DEM_NOT_FINITE;
            w->failed_id = w->id[i];
            return 0;
        }
    }
    return 1;
}

/* Returns how far two particles can approach each other in the next step [m], in the frame of the list. */
static inline double dem__most_approach(const dem_world *w) {
    const double dt = w->engine->run.dt;
    const dem_vec way =
        dem__scale(dt, dem__plus(w->engine->pairs.frame_velocity, 0.5 * dt, w->engine->pairs.frame_acceleration));
    double farthest = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        /* a particle that moves farther is too fast */
        const double tau = dem__now(w, i), most = 0.75 * w->particle[i].radius;
        const double moved = dem__length(dem__sub(dem__sub(dem__at(w, i, tau + dt), dem__at(w, i, tau)), way));
        const double counts = moved < most ? moved : most;
        farthest = counts > farthest ? counts : farthest;
    }
    return 2.0 * farthest;
}

/* Chooses the skin so that a list lasts long enough, for one step at least, and sets what depends on it. */
static inline void dem__choose_skin(dem_world *w, int keeps, double smallest, double largest) {
    dem__pairs *pairs = &w->engine->pairs;
    pairs->steps_per_second = (1.0 - 1e-9) / w->engine->run.dt; /* a little less, so that times are not rounded up */
    const int few = pairs->count < DEM__FEW_PAIRS * w->count, lasts = few ? 4 * DEM__LIST_STEPS : DEM__LIST_STEPS;
    if (keeps) pairs->skin_factor *= (double)lasts / (double)(w->step - pairs->listed_step + 1);
    pairs->skin_factor = dem__clamp(pairs->skin_factor, 1.0, 3.0);
    const double usual = 2.0 * smallest * w->def.skin * pairs->skin_factor, least = 1.05 * dem__most_approach(w),
                 wanted = usual > least ? usual : least,
                 room = 0.5 * dem__narrowest(w) - 2.0 * largest; /* an image is no second neighbour */
    pairs->skin = w->count == 0 ? 1.0 : wanted < room ? wanted : room;
    pairs->least_tolerance = 0.05 * pairs->skin / (DEM__RETEST_STEPS * w->engine->run.dt);
    pairs->wall_reach = 4.0 * pairs->skin;
    const double rounding = dem__position_rounding(w), most = 0.25 * pairs->skin;
    /* as much as corrections of slow contacts shift a particle. Faster contacts are rare, and a larger tolerance would
       cost more tests of near pairs */
    pairs->position_tolerance = 2e-6 * smallest + (rounding < most ? rounding : most);
}
