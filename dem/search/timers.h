/* Timers of near pairs and of particles with walls, and batches of them. Relies on motion/motion.h for positions; reads
   the bounds that search/bounds.h sets. */
#pragma once
#include "../particles/particles.h"

/* A timer holds the step in which a near pair, or a particle and a wall, is tested next. */

DEM_INLINE void dem__set_due(dem__timers *t, int32_t e, int32_t due) {
    int32_t *earliest = &t->earliest[(uint32_t)e / DEM__LINE];
    t->due[e] = due;
    *earliest = due < *earliest ? due : *earliest;
}
DEM_INLINE void dem__set_timer(dem__timers *t, int32_t e, int64_t step) {
    dem__set_due(t, e, (int32_t)(step - t->from));
}
DEM_INLINE void dem__stop_timer(dem__timers *t, int32_t e) { t->due[e] = DEM__STOPPED; }

DEM_INLINE int32_t dem__earliest(const int32_t *due) {
    int32_t earliest = DEM__STOPPED;
    DEM__NO_UNROLL
    for (int k = 0; k < DEM__LINE; k++) earliest = due[k] < earliest ? due[k] : earliest;
    return earliest;
}

/* Appends the due timers of line b to a list of n entries, and sets them to `then`. Returns the new number of
   entries. */
DEM_INLINE ptrdiff_t dem__take_due_of_line(dem__timers *t, ptrdiff_t b, int32_t now, int32_t then, int32_t *list,
                                           ptrdiff_t n) {
    int32_t *due = t->due + b * DEM__LINE;
    t->earliest[b] = dem__earliest(due);
    if (t->earliest[b] > now) return n; /* the earliest timer has been set to a later step since */
    for (int k = 0; k < DEM__LINE; k++) {
        list[n] = (int32_t)(b * DEM__LINE) + k;
        n += due[k] <= now;
    }
    DEM__NO_UNROLL
    for (int k = 0; k < DEM__LINE; k++) due[k] = due[k] <= now ? then : due[k];
    t->earliest[b] = dem__earliest(due);
    return n;
}

/* Lists the timers in pages first .. end-1 that are due at a step, from list[first * DEM__PAGE] on, and sets them to
   `then`. Returns how many. */
DEM_INLINE ptrdiff_t dem__find_due(dem__timers *t, ptrdiff_t first, ptrdiff_t end, int64_t step, int32_t then) {
    const int32_t now = (int32_t)(step - t->from);
    int32_t *list = t->list + first * DEM__PAGE;
    ptrdiff_t n = 0;
    int32_t open[4 * DEM__LINE];
    int opened = 0;
    for (ptrdiff_t s = first; s < end; s++) {
        const int32_t *earliest = &t->earliest[s * DEM__LINE];
        int any = 0;
        DEM__NO_UNROLL
        for (int k = 0; k < DEM__LINE; k++) any |= earliest[k] <= now;
        const int before = opened;
        for (int k = 0; k < DEM__LINE && any; k++) { /* no branch, because it would be mispredicted */
            open[opened] = (int32_t)(s * DEM__LINE) + k;
            opened += earliest[k] <= now;
        }
        for (int k = before; k < opened; k++) DEM__PREFETCH(&t->due[open[k] * DEM__LINE]);
        if (opened <= 3 * DEM__LINE && s + 1 < end) continue;
        for (int k = 0; k < opened; k++) n = dem__take_due_of_line(t, open[k], now, then, list, n);
        opened = 0;
    }
    return n;
}
DEM__AVX2_CLONE(dem__list_due,
                (dem__timers * t, ptrdiff_t first, ptrdiff_t end, int64_t step, int32_t then, ptrdiff_t *n),
                (t, first, end, step, then, n), *n = dem__find_due(t, first, end, step, then))

/* Returns the number of steps from `step` until the timer is due. */
DEM_INLINE int dem__steps_due(const dem__timers *t, int32_t e, int64_t step) {
    return (int)(t->due[e] - (step - t->from));
}
/* Returns the number of steps from `step` on in which no contact with the wall can begin. It may exceed
   dem__steps_due. */
DEM_INLINE int dem__steps_sure(const dem_world *w, int32_t e, int64_t step) {
    return (int)(int32_t)(w->engine->walls.sure[e] - (uint32_t)(uint64_t)step);
}

/* Converts a time [s] without contact to the number of steps until the next test, 1 to DEM__STEPS_MAX - 1. */
DEM_INLINE int dem__steps_until(const dem_world *w, double t) {
    double n = t * w->engine->pairs.steps_per_second;
    if (n >= (double)(DEM__STEPS_MAX - 2)) return DEM__STEPS_MAX - 1;
    return n > 0.0 ? 1 + (int)n : 1; /* NaN: 1 */
}

/* Returns the time [s] to cover a distance [m] at a speed s [m/s] that grows by g [m/s2]; 0 without a distance. */
DEM_INLINE double dem__time_to_cover(double distance, double s, double g) {
    return distance > 0.0 ? 2.0 * distance / (s + sqrt(s * s + 2.0 * g * distance)) : 0.0;
}

/* Returns the least time [s] to close a distance [m] at an approach speed u [m/s] (< 0: receding) and an acceleration
   of at most a [m/s2]; infinity if it never closes. */
DEM_INLINE double dem__time_to_close(double distance, double u, double a) {
    const double root = u + sqrt(u * u + 2.0 * a * distance);
    return distance > 0.0 ? (root > 0.0 ? 2.0 * distance / root : HUGE_VAL) : 0.0;
}

/* Returns the vector from the centre of j to the nearest image of i at a step [m]. Neither belongs to a rigid body. */
DEM_INLINE dem_vec dem__sphere_separation(const dem_world *w, ptrdiff_t i, ptrdiff_t j, int64_t step) {
    return dem__nearest_image(
        w, dem__sub(dem__sphere_at(w, i, (double)(step - w->particle[i].origin) * w->engine->run.dt),
                    dem__sphere_at(w, j, (double)(step - w->particle[j].origin) * w->engine->run.dt)));
}
/* Returns the same vector for any two particles. */
DEM_INLINE dem_vec dem__pair_separation(const dem_world *w, ptrdiff_t i, ptrdiff_t j, int64_t step) {
    return dem__nearest_image(w, dem__sub(dem__at(w, i, (double)(step - w->particle[i].origin) * w->engine->run.dt),
                                          dem__at(w, j, (double)(step - w->particle[j].origin) * w->engine->run.dt)));
}

typedef double dem__row[DEM__BLOCK];

/* Near pairs whose timers are computed together, and the results of tests. */
typedef struct dem__timer_batch {
    dem__bound apart[DEM__BLOCK]; /* bound of one particle relative to the other; they touch within `reach` */
    int32_t pair[DEM__BLOCK], steps[DEM__BLOCK];
    int n;
    int32_t *found; /* tests: pairs that touch */
    ptrdiff_t touch;
    int64_t looks;
} dem__timer_batch;

DEM_INLINE void dem__clear_batch(dem__timer_batch *q) { q->n = 0, q->found = NULL, q->touch = 0, q->looks = 0; }

/* Computes the number of steps until each pair can touch while both particles keep to their bounds: 0 for never, else 1
   to DEM__STEPS_MAX - 1. pace: steps a second. */
DEM_INLINE void dem__compute_due_steps(dem__timer_batch *q, double pace) {
    for (int k = 0; k < q->n; k++) {
        const dem__bound *r = &q->apart[k];
        const double a = r->ux * r->ux + r->uy * r->uy + r->uz * r->uz - r->tolerance * r->tolerance;
        const double b = r->x * r->ux + r->y * r->uy + r->z * r->uz - r->reach * r->tolerance;
        const double c = r->x * r->x + r->y * r->y + r->z * r->z - r->reach * r->reach;
        const double root = b * b - a * c, below = sqrt(root > 0.0 ? root : 0.0) - b;
        const double n = c / (below > 0.0 ? below : 1.0) * pace, later = n >= (double)(DEM__STEPS_MAX - 2)
                                                                             ? (double)(DEM__STEPS_MAX - 2)
                                                                         : n > 0.0 ? n
                                                                                   : 0.0;
        const double otherwise = ((root <= 0.0) | (below <= 0.0)) ? 0.0 : 1.0; /* NaN, after an overflow: 1 step */
        const double steps = ((root > 0.0) & (below > 0.0)) ? 1.0 + later : otherwise;
        q->steps[k] = (int32_t)(c > 0.0 ? steps : 1.0);
    }
}
DEM__AVX2_CLONE(dem__compute_due, (dem__timer_batch * q, double pace), (q, pace), dem__compute_due_steps(q, pace))

/* Computes and sets the timers of the pairs in the batch, and empties it. */
static inline void dem__flush_batch(dem_world *w, dem__timer_batch *q, int64_t step) {
    dem__pairs *pairs = &w->engine->pairs;
    const int32_t now = (int32_t)(step - pairs->timers.from);
    dem__compute_due(q, pairs->steps_per_second);
    for (int k = 0; k < q->n; k++)
        dem__set_due(&pairs->timers, q->pair[k], q->steps[k] > 0 ? now + q->steps[k] : DEM__NEVER);
    q->n = 0;
}

/* Computes how many steps remain until the pairs in the batch are due, appends pairs and steps to a list of n entries
   at `to`, and empties the batch. Returns the new number of entries. */
static inline ptrdiff_t dem__list_batch(const dem_world *w, dem__timer_batch *q, int32_t *to, ptrdiff_t n) {
    dem__compute_due(q, w->engine->pairs.steps_per_second);
    for (int k = 0; k < q->n; k++, n++) to[2 * n] = q->pair[k], to[2 * n + 1] = q->steps[k];
    q->n = 0;
    return n;
}
/* Sets n timers that dem__list_batch has listed. */
static inline void dem__set_listed(dem_world *w, const int32_t *list, ptrdiff_t n, int64_t step) {
    dem__timers *t = &w->engine->pairs.timers;
    const int32_t now = (int32_t)(step - t->from);
    for (ptrdiff_t k = 0; k < n; k++) {
        if (k + DEM__AHEAD < n) {
            DEM__PREFETCH(&t->due[list[2 * (k + DEM__AHEAD)]]);
            DEM__PREFETCH(&t->earliest[list[2 * (k + DEM__AHEAD)] / DEM__LINE]);
        }
        dem__set_due(t, list[2 * k], list[2 * k + 1] > 0 ? now + list[2 * k + 1] : DEM__NEVER);
    }
}

/* Returns the time since the list was built [s]; bounds are functions of it. */
DEM_INLINE double dem__since_listed(const dem_world *w, int64_t step) {
    return (double)(step - w->engine->pairs.listed_step) * w->engine->run.dt;
}

/* Returns the bound as it is t [s] after the list was built. */
DEM_INLINE dem__bound dem__bound_at(const dem__bound *c, double t) {
    dem__bound now = *c;
    now.x += t * c->ux, now.y += t * c->uy, now.z += t * c->uz, now.reach += t * c->tolerance;
    return now;
}

/* Appends pair p to the batch with the bound of a relative to b. Returns that bound. */
DEM_INLINE dem__bound *dem__batch_pair(dem_world *w, dem__timer_batch *q, int32_t p, int64_t step, const dem__bound *a,
                                       const dem__bound *b) {
    if (q->n == DEM__BLOCK) dem__flush_batch(w, q, step);
    dem__bound *r = &q->apart[q->n];
    q->pair[q->n++] = p;
    r->x = a->x - b->x, r->y = a->y - b->y, r->z = a->z - b->z, r->reach = a->reach + b->reach;
    r->ux = a->ux - b->ux, r->uy = a->uy - b->uy, r->uz = a->uz - b->uz, r->tolerance = a->tolerance + b->tolerance;
    return r;
}

/* Appends pair p. a, b: the bounds of its particles at the step; their nearest images are taken. */
DEM_INLINE void dem__batch_bounds(dem_world *w, dem__timer_batch *q, int32_t p, int64_t step, const dem__bound *a,
                                  const dem__bound *b) {
    dem__bound *r = dem__batch_pair(w, q, p, step, a, b);
    if (!w->engine->run.has_periodic) return;
    const dem_vec d = dem__nearest_image(w, dem_vec3(r->x, r->y, r->z));
    r->x = d.x, r->y = d.y, r->z = d.z;
}

/* Appends pair p, whose centres are d apart [m] at a step. */
DEM_INLINE void dem__batch_separation(dem_world *w, dem__timer_batch *q, int32_t p, int64_t step, dem_vec d) {
    const dem__near *pair = &w->engine->pairs.near[p];
    dem__bound *r =
        dem__batch_pair(w, q, p, step, &w->engine->bodies.bound[pair->i], &w->engine->bodies.bound[pair->j]);
    r->x = d.x, r->y = d.y, r->z = d.z, r->reach = pair->distance + 2.0 * w->engine->pairs.position_tolerance;
}
