/* Bounds on particles' motion, and the timers that depend on them. */
#pragma once
#include "../walls/motion.h"
#include "../base/parallel.h"
#include "timers.h"

/* Marks an active particle for dem__check_bounds. */
DEM_INLINE void dem__mark_one(dem_world *w, ptrdiff_t i) {
    dem__bodies *bodies = &w->engine->bodies;
    if (bodies->activity[i] != 1) return;
    bodies->activity[i] = 2;
    bodies->to_check[bodies->to_check_count++] = (int32_t)i;
}
/* Marks particle i, or all particles of its rigid body. */
DEM_INLINE void dem__mark_to_check(dem_world *w, ptrdiff_t i) {
    const dem__pieces own = dem__pieces_of(w, i);
    for (ptrdiff_t k = own.first; k < own.end; k++) dem__mark_one(w, k);
}

/* Returns a limit of how much an acceleration changes the velocity in one step [m/s]. A sum of components needs no
   root. */
DEM_INLINE double dem__most_change(double dt, dem_vec pull) {
    return dt * (fabs(pull.x) + fabs(pull.y) + fabs(pull.z));
}

/* Sets by how much the velocity of particle i may still change before it leaves its bound [m/s]. deviation: how far it
   is from the bound's velocity now [m/s]. */
DEM_INLINE void dem__set_tolerance_left(dem_world *w, ptrdiff_t i, double deviation) {
    w->particle[i].tolerance_left__ =
        w->engine->bodies.bound[i].tolerance - deviation -
        dem__most_change(w->engine->run.dt, dem__sub(w->particle[i].a, dem__free_fall(w)));
}

/* Sets a new bound for particle i, which is at x with velocity v at a step.

   In an impact that has just begun, the velocity changes about as much after the middle of the impact as before it. The
   bound has the velocity of the middle, and its tolerance includes both ends, so one bound lasts for the whole impact.
   Otherwise the tolerance allows 16 steps of the present force and a little more. In flight it is very small: only a
   contact changes the velocity, and small tolerances give late timers. */
DEM_INLINE void dem__set_bound(dem_world *w, ptrdiff_t i, int64_t step, dem_vec x, dem_vec v) {
    dem__bodies *bodies = &w->engine->bodies;
    const dem__pairs *pairs = &w->engine->pairs;
    const double t = dem__since_listed(w, step);
    const dem_vec g = dem__free_fall(w), impact = w->touching[i] == 1 ? bodies->impact[i] : dem_vec3(0.0, 0.0, 0.0);
    const dem__rigid *body =
        w->touching[i] == 0 ? dem__rigid_of(w, i) : NULL; /* a body in flight turns about its centre of mass */
    const double turning_speed = body ? dem__turning_speed_of(w, i) : 0.0;
    const dem_vec u = body ? dem__plus(body->v, (double)(step - w->particle[i].origin) * w->engine->run.dt, body->a)
                           : dem__add(v, impact);
    const double turn = body ? dem__length(dem__sub(v, u)) : dem__length(impact),
                 held = 16.0 * w->engine->run.dt * dem__length(dem__sub(w->particle[i].a, g));
    dem__bound *c = &bodies->bound[i];
    c->ux = u.x - t * g.x, c->uy = u.y - t * g.y, c->uz = u.z - t * g.z;
    c->x = x.x - t * (u.x - 0.5 * t * g.x), c->y = x.y - t * (u.y - 0.5 * t * g.y),
    c->z = x.z - t * (u.z - 0.5 * t * g.z);
    bodies->shifted[i] = 0.0;
    if (turn > 0.0 && !body)
        c->tolerance = 0.25 * pairs->least_tolerance + 1.1 * turn + 0.125 * held; /* more than the next step needs */
    else c->tolerance = (w->touching[i] == 0 ? 0.001 : 1.0) * pairs->least_tolerance + held;
    c->tolerance += turning_speed;
    DEM__ADD_UP(w, c->tolerance, drift, (w, i));
    c->reach = w->particle[i].radius + 0.5 * pairs->touch_gap + pairs->position_tolerance - t * c->tolerance;
    dem__set_tolerance_left(w, i, turn);
}

/* Returns the rounding error of the position that is farthest from the origin [m]. */
static inline double dem__position_rounding(const dem_world *w) {
    double farthest = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const double far = dem__length(w->particle[i].x);
        farthest = w->alive[i] == DEM_PRESENT && far > farthest ? far : farthest;
    }
    return 8.0 * DBL_EPSILON * farthest;
}

/* What new bounds lead to, one for each thread: the step in which the list must be checked, and a particle that is too
   fast (-1: none). */
typedef struct dem__outcome {
    int64_t check;
    ptrdiff_t fast;
} dem__outcome;
DEM_INLINE dem__outcome dem__no_outcome(const dem_world *w) {
    const dem__outcome outcome = {w->engine->pairs.next_check, -1};
    return outcome;
}
static inline void dem__apply_outcome(dem_world *w, const dem__outcome *outcome) {
    if (outcome->check < w->engine->pairs.next_check) w->engine->pairs.next_check = outcome->check;
    if (outcome->fast < 0 || w->status != DEM_OK) return;
    w->status = DEM_TOO_FAST;
    w->failed_id = w->id[outcome->fast];
}

/* The frame in which the list measures how far particles have moved: its displacement since the list was built [m] and
   its velocity [m/s]. */
typedef struct dem__list_frame {
    dem_vec way, velocity;
} dem__list_frame;
DEM_INLINE dem__list_frame dem__frame_at(const dem_world *w, int64_t step) {
    const dem__pairs *pairs = &w->engine->pairs;
    const double t = dem__since_listed(w, step);
    dem__list_frame f;
    f.way = dem__scale(t, dem__plus(pairs->frame_velocity, 0.5 * t, pairs->frame_acceleration));
    f.velocity = dem__plus(pairs->frame_velocity, t, pairs->frame_acceleration);
    return f;
}

/* How far a particle may move in that frame before it could touch one that is not listed, and how fast it moves there
   at most. */
typedef struct dem__skin_left {
    double left, speed; /* [m], [m/s] */
} dem__skin_left;
DEM_INLINE dem__skin_left dem__skin_left_of(const dem_world *w, ptrdiff_t i, const dem__list_frame *f, dem_vec x,
                                            dem_vec v) {
    dem__skin_left q;
    q.left = 0.49 * w->engine->pairs.skin -
             dem__length(dem__nearest_image(w, dem__sub(x, dem__add(w->engine->pairs.listed_at[i], f->way))));
    q.speed = dem__length(dem__sub(v, f->velocity)) + 2.0 * w->engine->bodies.bound[i].tolerance;
    return q;
}

/* Returns for how many whole steps the skin lasts. The list is checked before the first step that the skin does not
   cover. */
DEM_INLINE int dem__steps_left(const dem_world *w, const dem__skin_left *q) {
    return dem__steps_until(w, dem__time_to_cover(q->left, q->speed, w->engine->pairs.frame_fall)) - 1;
}

/* Returns whether the skin lasts for a time [s]; false for NaN. */
DEM_INLINE int dem__lasts(const dem_world *w, const dem__skin_left *q, double time) {
    return q->left > time * (q->speed + 0.5 * w->engine->pairs.frame_fall * time);
}

/* Applies what follows from a new bound of particle i: the next check of the list, the speed limit, its wall timers.
   shifted: how far corrections moved it from the last bound [m]. Returns 1 if a wall must be tested sooner than its
   timer says; the caller then calls dem__advance_wall_timers. */
DEM_INLINE int dem__apply_bound(dem_world *w, ptrdiff_t i, int64_t step, const dem__list_frame *f, dem_vec x, dem_vec v,
                                double shifted, dem__outcome *outcome) {
    const dem__run *run = &w->engine->run;
    dem__bodies *bodies = &w->engine->bodies;
    dem__wall_state *walls = &w->engine->walls;
    const dem__skin_left skin = dem__skin_left_of(w, i, f, x, v);
    double speed = dem__length(v);
    int sooner = 0;
    if (!(speed * run->dt <= dem__longest_step(w, i)) && outcome->fast < 0) outcome->fast = i;
    speed += 2.0 * bodies->bound[i].tolerance;
    if (!dem__lasts(w, &skin, (double)(outcome->check - step) * run->dt)) {
        /* 0: a host moved the particle, so check at once */
        const int64_t due = skin.left > 0.0 ? step + dem__steps_left(w, &skin) : step;
        if (due < outcome->check) outcome->check = due;
    }
    if (!(w->def.skip & DEM_SKIP_SPACE)) return 0;
    double slower = 1.0; /* wall timers relied on a lower speed: they last fewer steps */
    if (speed > bodies->wall_speed[i]) {
        slower = bodies->wall_speed[i] / (1.25 * speed);
        bodies->wall_speed[i] = 1.25 * speed;
    }
    const double lost =
        shifted > 0.0 ? 1.0 + shifted / (bodies->wall_speed[i] * run->dt) : 0.0; /* the shift, in steps at that speed */
    for (int k = 0; k < w->walls; k++) {
        const int32_t e = (int32_t)i * w->walls + k;
        if (walls->timers.due[e] == DEM__STOPPED) continue;
        const double left = (double)(dem__steps_sure(w, e, step) - 1) * slower - lost;
        const int now = left > 0.0 ? 1 + (int)left : 1;
        walls->sure[e] = (uint32_t)(uint64_t)(step + now); /* the test computes the step again */
        sooner |= now < dem__steps_due(&walls->timers, e, step);
    }
    return sooner;
}
/* Brings forward the wall timers of particle i that are later than walls.sure. */
static inline void dem__advance_wall_timers(dem_world *w, ptrdiff_t i, int64_t step) {
    dem__wall_state *walls = &w->engine->walls;
    for (int k = 0; k < w->walls; k++) {
        const int32_t e = (int32_t)i * w->walls + k;
        const int sure = dem__steps_sure(w, e, step), due = walls->timers.due[e];
        if (due != DEM__STOPPED && sure < dem__steps_due(&walls->timers, e, step))
            dem__set_timer(&walls->timers, e, step + sure);
    }
}

/* Sets a new bound for particle i and applies what follows, except for its pairs: see dem__reset_pair_timers. Not
   thread-safe. */
static inline void dem__renew_bound(dem_world *w, ptrdiff_t i, int64_t step) {
    const double shifted = w->engine->bodies.shifted[i],
                 tau = (double)(step - w->particle[i].origin) * w->engine->run.dt;
    const dem_vec x = dem__at(w, i, tau), v = dem__velocity_at(w, i, tau);
    const dem__list_frame frame = dem__frame_at(w, step);
    dem__outcome outcome = dem__no_outcome(w);
    dem__set_bound(w, i, step, x, v);
    if (dem__apply_bound(w, i, step, &frame, x, v, shifted, &outcome)) dem__advance_wall_timers(w, i, step);
    dem__apply_outcome(w, &outcome);
}

/* Makes all particles due for a test with wall k at a step. */
static inline void dem__test_wall_by_all(dem_world *w, int k, int64_t step) {
    for (ptrdiff_t i = 0; i < w->count && (w->def.skip & DEM_SKIP_SPACE); i++) {
        const int32_t e = (int32_t)i * w->walls + k;
        if (w->engine->walls.timers.due[e] != DEM__STOPPED) dem__set_timer(&w->engine->walls.timers, e, step);
    }
}

/* Moves walls to a step. Timers rely on a limit of each wall's speed. A driven wall that exceeds it gets a larger one
   and is tested with all particles in this step. Returns 0 if a wall's position is not finite. */
static inline int dem__move_walls(dem_world *w, int64_t step) {
    const dem__run *run = &w->engine->run;
    const double time = run->start_time + (double)(step - run->start_step) * run->dt;
    const dem_wall *last = NULL; /* the wall for which `oscillation` was computed */
    dem__oscillation oscillation;
    for (int k = 0; k < w->walls; k++) {
        dem_wall *a = &w->wall[k];
        const double t = time - a->asked.motion_start;
        if (a->asked.drive == DEM_KINEMATIC) {
            if (!(a->speed_bound > 0.0 || a->spin_bound > 0.0)) continue;
            if (!last || !dem__oscillates_like(a, last)) oscillation = dem__oscillation_at(a, t);
            last = a;
            dem__kinematic_wall(a, t, &oscillation);
            continue;
        }
        const dem_vec from = a->position, axis[3] = {a->axis[0], a->axis[1], a->axis[2]};
        double turn = 0.0;
        dem__move_wall(a, time);
        if (!dem__wall_is_finite(a)) return 0;
        const double speed = dem__length(dem__sub(a->position, from)) / run->dt;
        for (int q = 0; q < 3; q++) { /* at least one axis turns by sqrt(2/3) of the angle */
            const double tip = 1.25 * dem__length(dem__sub(a->axis[q], axis[q])) / run->dt;
            turn = tip > turn ? tip : turn;
        }
        if (speed <= a->speed_bound && turn <= a->spin_bound) continue;
        a->speed_bound = speed > a->speed_bound ? 1.5 * speed : a->speed_bound;
        a->spin_bound = turn > a->spin_bound ? 1.5 * turn : a->spin_bound;
        dem__test_wall_by_all(w, k, step);
    }
    return 1;
}

/* Prefetches the timers of particle i's near pairs and the bounds of the other particles. */
DEM_INLINE void dem__prefetch_neighbours(const dem_world *w, ptrdiff_t i) {
    const dem__pairs *pairs = &w->engine->pairs;
    for (int32_t k = pairs->adjacent_start[i]; k < pairs->adjacent_start[i + 1]; k++) {
        DEM__PREFETCH(&pairs->timers.due[pairs->adjacent[2 * k]]);
        DEM__PREFETCH(&w->engine->bodies.bound[pairs->adjacent[2 * k + 1]]);
    }
}

/* Returns the near pair of two particles, or -1. */
static inline int32_t dem__near_pair(const dem_world *w, int32_t i, int32_t j) {
    const dem__pairs *pairs = &w->engine->pairs;
    if (w->engine->run.needs_lists) return -1;
    for (int32_t a = pairs->adjacent_start[i]; a < pairs->adjacent_start[i + 1]; a++) {
        if (pairs->adjacent[2 * a + 1] == j) return pairs->adjacent[2 * a];
    }
    return -1;
}

/* New timers of the near pairs of n particles with new bounds. */
typedef struct dem__reset_list {
    const int32_t *particle;
    ptrdiff_t n, room; /* room: entries of a thread's list; 0: one thread sets the timers at once */
    int64_t step;
    ptrdiff_t listed[DEM__PARTS_MAX];
    int parts;
} dem__reset_list;

/* Computes the timers of the pairs of particles reset[0 .. n-1]. Sets them, or appends them to `list` if it has room
   (`room` entries). Returns how many were listed, or -1 if they do not fit. */
DEM_INLINE ptrdiff_t dem__reset_timers_of(dem_world *w, const int32_t *reset, ptrdiff_t n, int64_t step, int32_t *list,
                                          ptrdiff_t room) {
    dem__pairs *pairs = &w->engine->pairs;
    const double t = dem__since_listed(w, step);
    ptrdiff_t listed = 0;
    dem__timer_batch waits;
    dem__clear_batch(&waits);
    for (ptrdiff_t m = dem__prefetch_from(n, 16); m < n; m++) {
        /* prefetch in three stages: where a list of neighbours begins, the list, the particles in it */
        if (m + 16 < n) DEM__PREFETCH(&pairs->adjacent_start[reset[m + 16]]);
        if (m >= -8 && m + 8 < n) {
            const int32_t *neighbours = &pairs->adjacent[2 * pairs->adjacent_start[reset[m + 8]]];
            DEM__PREFETCH(neighbours);
            DEM__PREFETCH(neighbours + 16);
        }
        if (m >= -2 && m + 2 < n) dem__prefetch_neighbours(w, reset[m + 2]);
        if (m < 0) continue;
        const int32_t i = reset[m], begin = pairs->adjacent_start[i], stop = pairs->adjacent_start[i + 1];
        const dem__bound own = dem__bound_at(&w->engine->bodies.bound[i], t);
        for (int32_t k = begin; k < stop; k++) {
            const int32_t p = pairs->adjacent[2 * k];
            if (pairs->timers.due[p] == DEM__STOPPED) continue;
            if (list && waits.n == DEM__BLOCK) {
                if (listed + 2 * DEM__BLOCK > room) return -1;
                listed = dem__list_batch(w, &waits, list, listed);
            }
            const dem__bound other = dem__bound_at(&w->engine->bodies.bound[pairs->adjacent[2 * k + 1]], t);
            dem__batch_bounds(w, &waits, p, step, &own, &other);
        }
    }
    if (list) return dem__list_batch(w, &waits, list, listed);
    dem__flush_batch(w, &waits, step);
    return 0;
}
DEM__AVX2_CLONE(dem__reset_timers_part,
                (dem_world * w, const int32_t *reset, ptrdiff_t n, int64_t step, int32_t *list, ptrdiff_t room,
                 ptrdiff_t *listed),
                (w, reset, n, step, list, room, listed), *listed = dem__reset_timers_of(w, reset, n, step, list, room))

/* Computes the new timers of the pairs of particles first .. end-1 and lists them in this thread's part of timers.list,
   which is free between two searches for due tests. */
static inline void dem__list_resets(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    dem__reset_list *q = (dem__reset_list *)context;
    dem__reset_timers_part(w, q->particle + first, end - first, q->step,
                           w->engine->pairs.timers.list + 2 * q->room * part, q->room, &q->listed[part]);
}
/* Sets those of the listed timers that lie in this thread's lines: every `parts`-th group of 64. */
static inline void dem__set_resets(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__reset_list *q = (const dem__reset_list *)context;
    dem__timers *t = &w->engine->pairs.timers;
    const int32_t now = (int32_t)(q->step - t->from), parts = (int32_t)q->parts;
    (void)first, (void)end;
    for (int of = 0; of < q->parts; of++) {
        const int32_t *list = t->list + 2 * q->room * of;
        for (ptrdiff_t k = 0; k < q->listed[of]; k++) {
            const int32_t p = list[2 * k], steps = list[2 * k + 1];
            if (p / (64 * DEM__LINE) % parts == part) dem__set_due(t, p, steps > 0 ? now + steps : DEM__NEVER);
        }
    }
}

/* Sets new timers for the near pairs of n particles with new bounds. All threads compute them. Then each thread sets
   those in its own lines, because the timers of a line share their earliest step. */
static inline void dem__reset_pair_timers(dem_world *w, const int32_t *reset, ptrdiff_t n, int64_t step) {
    dem__reset_list q;
    ptrdiff_t nothing, listed = 0, least = 0;
    q.particle = reset, q.n = n, q.step = step, q.parts = dem__parts(w, 8 * n);
    if (n == 0 || w->engine->pairs.count == 0) return; /* without pairs there is no list of neighbours */
    if (!(w->def.skip & DEM_SKIP_PAIRS)) return;
    q.room = w->engine->pairs.timers.pages * DEM__PAGE / 2 / q.parts;
    if (q.parts > 1 && q.room > 2 * DEM__BLOCK) {
        dem__in_parts(w, q.parts, n, dem__list_resets, &q);
        for (int k = 0; k < q.parts; k++) listed += q.listed[k], least = q.listed[k] < least ? q.listed[k] : least;
        if (least >= 0 && dem__parts(w, listed / 4) > 1) dem__in_parts(w, q.parts, q.parts, dem__set_resets, &q);
        for (int k = 0; k < q.parts && least >= 0 && dem__parts(w, listed / 4) == 1; k++)
            dem__set_listed(w, w->engine->pairs.timers.list + 2 * q.room * k, q.listed[k], step);
        if (least >= 0) return;
    }
    dem__reset_timers_part(w, reset, n, step, NULL, 0, &nothing);
}
