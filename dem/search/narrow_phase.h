/* The narrow phase. A test of a pair, or of a particle and a wall, finds that a contact begins, or the next step in
   which one is possible. New contacts are appended to the last chunk. */
#pragma once
#include "../walls/kinds.h"
#include "../base/parallel.h"
#include "timers.h"
#include "../particles/exits.h"

/* Returns the slot of contact k. In public functions contacts are numbered from 0 in the order of slots. */
DEM_INLINE ptrdiff_t dem__slot_of(const dem_world *w, ptrdiff_t k) {
    const dem__chunk *in = w->engine->contacts.chunk;
    while (k >= in->count) k -= in++->count;
    return in->first + k;
}
/* Returns the number of the contact in slot c. */
DEM_INLINE int32_t dem__number_of(const dem_world *w, ptrdiff_t c) {
    const dem__chunk *in = w->engine->contacts.chunk;
    ptrdiff_t before = 0;
    while (c >= in->first + in->count) before += in++->count;
    return (int32_t)(before + c - in->first);
}

/* Returns the slot of the next contact that begins. */
DEM_INLINE ptrdiff_t dem__next_slot(const dem_world *w) {
    const dem__chunk *last = &w->engine->contacts.chunk[w->engine->contacts.chunk_count - 1];
    return last->first + last->count;
}

static inline int dem__grow_contacts(dem_world *w, ptrdiff_t slots) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__array list[DEM__ARRAYS_MAX];
    return slots <= contacts->capacity ||
           (slots <= INT32_MAX / 2 && dem__grow_group(w, list, dem__contact_arrays(w, list), &contacts->block,
                                                      &contacts->bytes, &contacts->capacity, slots));
}

/* Appends a contact, which dem__commit_begun completes. Returns 0 when out of memory. */
static inline int dem__new_contact(dem_world *w, ptrdiff_t i, ptrdiff_t j, int32_t element, int32_t near_pair) {
    dem__contacts *contacts = &w->engine->contacts;
    const ptrdiff_t c = dem__next_slot(w);
    if (!dem__grow_contacts(w, c + 1)) {
        w->status = DEM_OUT_OF_MEMORY;
        return 0;
    }
    contacts->count++;
    contacts->chunk[contacts->chunk_count - 1].count++;
    contacts->i[c] = (int32_t)i;
    contacts->j[c] = (int32_t)j;
    contacts->element[c] = element;
    contacts->near[c] = near_pair;
    contacts->begun++;
    return 1;
}

/* Tests pair p. If it touches, adds it to the pairs found; otherwise, to those that need a new timer. */
DEM_INLINE void dem__test_pair(dem_world *w, dem__timer_batch *waits, int32_t p, int64_t step, int rigid) {
    const dem__near *q = &w->engine->pairs.near[p];
    const dem_vec d = rigid ? dem__pair_separation(w, q->i, q->j, step) : dem__sphere_separation(w, q->i, q->j, step);
    waits->looks++;
    if (dem__dot(d, d) < q->distance * q->distance) waits->found[waits->touch++] = p;
    else if (w->def.skip & DEM_SKIP_PAIRS) dem__batch_separation(w, waits, p, step, d);
}

/* Begins the contacts that tests of pairs have found. Allocates memory for all of them at once. */
static inline void dem__new_pair_contacts(dem_world *w, const int32_t *found, ptrdiff_t touch, int64_t looks) {
    dem__pairs *pairs = &w->engine->pairs;
    const ptrdiff_t slots = dem__next_slot(w) + touch;
    w->looks += looks;
    if (!dem__grow_contacts(w, slots > w->engine->contacts.capacity ? slots + slots / 2 : slots))
        w->status = DEM_OUT_OF_MEMORY;
    for (const int32_t *p = found; p < found + touch && w->status == DEM_OK; p++) {
        if (dem__new_contact(w, pairs->near[*p].i, pairs->near[*p].j, 0, *p)) dem__stop_timer(&pairs->timers, *p);
    }
}

static inline int dem__touches_element(const dem_world *w, ptrdiff_t i, int wall, int32_t element) {
    const dem__contacts *contacts = &w->engine->contacts;
    for (int32_t c = w->engine->walls.first_contact[i]; c >= 0; c = contacts->wall_next[c]) {
        if (contacts->j[c] == -1 - wall && contacts->element[c] == element) return 1;
    }
    return 0;
}

/* Returns an arm [m] such that no point of a wall at x is faster than speed_bound + arm * spin_bound. */
DEM_INLINE double dem__arm(const dem_wall *wall, dem_vec x) {
    const double arm =
        dem__length(dem__sub(x, wall->position)); /* speed_bound of a kinematic wall leaves out its rotation */
    return wall->asked.drive == DEM_KINEMATIC ? arm + dem__length(dem__sub(wall->asked.origin, wall->asked.spin_centre))
                                              : arm;
}

/* Returns whether particle i must be tested with a wall. A screen may be touched at several bars. A particle that
   touches any other wall needs no test: such a wall is touched at one place, and dem__follow_meshes finds the other
   places of a mesh. */
DEM_INLINE int dem__needs_test(const dem_world *w, ptrdiff_t i, int wall) {
    if (dem__is_fixed(w, i)) return 0;
    if (dem__shape_of(w, i))
        return !dem__has_surface(&w->wall[wall]); /* polyhedra/pairs.h tests corners and edges with all other walls */
    if (dem__has_elements(&w->wall[wall])) return 1;
    for (int32_t c = w->engine->walls.first_contact[i]; c >= 0; c = w->engine->contacts.wall_next[c]) {
        if (w->engine->contacts.j[c] == -1 - wall) return 0;
    }
    return 1;
}

/* Returns whether a polyhedron takes part in the contact in slot c. The functions below read and write what a contact
   keeps of the place where it touches: see DEM__PLACE_NORMAL in base/engine.h. first: the first of three numbers. */
DEM_INLINE int dem__is_convex_contact(const dem_world *w, ptrdiff_t c) { return w->engine->contacts.near[c] < -1; }
DEM_INLINE dem_vec dem__place_vec(const dem_world *w, int first, ptrdiff_t c) {
    double *const *place = &w->engine->contacts.touch[first];
    return dem_vec3(place[0][c], place[1][c], place[2][c]);
}
DEM_INLINE void dem__set_place_vec(dem_world *w, int first, ptrdiff_t c, dem_vec v) {
    double *const *place = &w->engine->contacts.touch[first];
    place[0][c] = v.x, place[1][c] = v.y, place[2][c] = v.z;
}
DEM_INLINE dem_vec dem__place_normal(const dem_world *w, ptrdiff_t c) {
    return dem__place_vec(w, DEM__PLACE_NORMAL, c);
}
DEM_INLINE dem_vec dem__place_before(const dem_world *w, ptrdiff_t c) {
    return dem__place_vec(w, DEM__PLACE_BEFORE, c);
}
DEM_INLINE dem_vec dem__place_arm(const dem_world *w, ptrdiff_t c) { return dem__place_vec(w, DEM__PLACE_ARM, c); }
/* Moves the contact in slot c to a place of its mesh. */
DEM_INLINE void dem__set_touch(dem_world *w, ptrdiff_t c, const dem__touch *touch) {
    dem__set_place_vec(w, DEM__PLACE_NORMAL, c, touch->normal);
    w->engine->contacts.touch[DEM__PLACE_GAP][c] = touch->gap;
}

/* Begins a contact with a wall. A cone is touched from both sides and at its rims, so a contact keeps the curvature
   with which it began. Returns 0 when out of memory. */
static inline int dem__new_wall_contact(dem_world *w, ptrdiff_t i, int wall, const dem__touch *touch, int32_t element) {
    dem__contacts *contacts = &w->engine->contacts;
    if (!dem__new_contact(w, i, -1 - wall, element, -1)) return 0;
    const ptrdiff_t c = dem__next_slot(w) - 1;
    if (dem__has(&w->wall[wall], DEM__KEEPS_CURVATURE)) contacts->touch[DEM__KEPT_CURVATURE][c] = touch->curvature;
    if (!dem__has(&w->wall[wall], DEM__TRIANGULATED)) return 1;
    dem__set_touch(w, c, touch);
    contacts->touch[DEM__PLACE_SLACK][c] = 0.0; /* no cached face yet */
    dem__set_place_vec(w, DEM__PLACE_BEFORE, c, touch->normal);
    return 1;
}

/* Returns whether a point is beyond an exit. A rigid body leaves when both its centre of mass and the centre of one of
   its particles are beyond it. */
static inline int dem__has_passed(const dem_wall *wall, dem_vec x) {
    return dem__dot(dem__sub(x, wall->position), wall->axis[2]) < 0.0;
}

/* Returns a lower limit of the gap to the elements that were not found [m]. */
static inline double dem__other_elements(const dem_world *w, const dem_wall *wall, double radius,
                                         const dem__touch *touch, int found) {
    double lowest = 0.0;
    for (int q = 0; q < found; q++) lowest = touch[q].gap < lowest ? touch[q].gap : lowest;
    const double others = wall->kind__->other_elements(wall, radius, lowest);
    return others < w->engine->pairs.wall_reach ? others : w->engine->pairs.wall_reach;
}

/* Returns the distance from x to the nearest face of the periodic box beyond which the wall does not continue [m].
   Walls are not repeated. */
static inline double dem__far_from_faces(const dem_world *w, const dem_wall *wall, dem_vec x) {
    double least = HUGE_VAL;
    for (int a = 0; a < 3; a++) {
        const double at = dem_axis(x, a);
        if (!w->def.periodic[a] ||
            (wall->spin_bound == 0.0 && wall->kind__->is_endless && wall->kind__->is_endless(wall, a)))
            continue;
        const double below = at - dem_axis(w->def.low, a), above = dem_axis(w->def.high, a) - at;
        least = below < least ? below : least;
        least = above < least ? above : least;
    }
    return least;
}

/* A test of particle i with wall k. */
typedef struct dem__wall_test {
    ptrdiff_t i;
    int k;
    dem_wall *wall;
    dem_vec x, v;  /* of the particle at the step of the test */
    double clear;  /* lower limit of the gaps where there is no contact [m] */
    double others; /* lower limit of the gaps to all places that were not found [m] */
    int found;
    dem__touch touch[DEM__TOUCHES];
} dem__wall_test;

/* Returns a time [s] before which the particle cannot touch the wall, from its velocity and the tolerance of its bound;
   0 if none is known. Near a wall it is longer than the time that follows from speeds alone, but it holds for this
   bound only. A plane, a bar and a cylinder from outside are convex: a gap to them shrinks fastest along its normal. */
static inline double dem__time_to_wall(const dem_world *w, const dem__wall_test *t) {
    const dem_wall *wall = t->wall;
    const double spread = 2.0 * w->engine->bodies.bound[t->i].tolerance,
                 near = w->engine->pairs.touch_gap + w->engine->pairs.position_tolerance,
                 radius = w->particle[t->i].radius;
    const dem_vec u = dem__sub(t->v, wall->velocity), g = dem__free_fall(w);
    double a = w->engine->pairs.gravity_size + wall->acceleration_bound, least = HUGE_VAL;
    if (t->found == 0 || wall->asked.drive != DEM_KINEMATIC || !dem__has(wall, DEM__CONVEX) || wall->spin != 0.0 ||
        !(a < HUGE_VAL))
        return 0.0;
    if (dem__has_elements(wall)) least = dem__time_to_close(t->others - near, dem__length(u) + spread, a);
    if (wall->kind__->closing) a = wall->kind__->closing(wall, t->touch, radius, g, u);
    for (int q = 0; q < t->found; q++) {
        if (dem__has_surface(wall) && dem__touches_element(w, t->i, t->k, t->touch[q].element)) continue;
        const double time = dem__time_to_close(t->touch[q].gap - near, spread - dem__dot(u, t->touch[q].normal), a);
        least = time < least ? time : least;
    }
    return least;
}

/* Removes a particle that is beyond an exit. A rigid body whose centre is not beyond it is tested again in the next
   step. */
static inline void dem__test_exit(dem_world *w, const dem__wall_test *t, int32_t e, int64_t step) {
    const dem__rigid *r = dem__rigid_of(w, t->i);
    const double tau = (double)(step - w->particle[t->i].origin) * w->engine->run.dt;
    if (!r || dem__has_passed(t->wall, dem__in_box(w, dem__body_at(r, tau)))) dem__pass_exit(w, t->i, t->k);
    else if (w->def.skip & DEM_SKIP_SPACE) dem__set_timer(&w->engine->walls.timers, e, step + 1);
}

/* Returns whether a feature needs the contact of particle i with an element of a wall before they touch. */
static inline int dem__begins_early(const dem_world *w, ptrdiff_t i, int wall, int32_t element) {
    int early = 0;
    DEM__ADD_UP(w, early, begins_early, (w, i, -1 - wall, element));
    return early;
}

/* Begins contacts at the places found, and computes how far the rest of the wall is. Returns 0 if the wall needs no
   other test: it is touched at its only place, or memory ran out. */
static inline int dem__begin_at_wall(dem_world *w, dem__wall_test *t) {
    const double near = w->engine->pairs.touch_gap;
    int touches = 0;
    if (dem__has_elements(t->wall))
        t->others = dem__other_elements(w, t->wall, w->particle[t->i].radius, t->touch, t->found);
    t->clear = t->others;
    for (int q = 0; q < t->found; q++) {
        const dem__touch *place = &t->touch[q];
        if (dem__touches_element(w, t->i, t->k, place->element)) continue;
        const int early = place->gap < near && dem__begins_early(w, t->i, t->k, place->element);
        if (place->gap < (early ? near : 0.0)) {
            if (!dem__new_wall_contact(w, t->i, t->k, place, place->element)) return 0;
            touches = 1;
        } else t->clear = place->gap - near < t->clear ? place->gap - near : t->clear;
    }
    return !touches || dem__has_elements(t->wall);
}

/* Returns a limit of the speed at which particle and wall approach each other now [m/s]. most: the number of steps for
   which it holds once gravity is added. */
static inline double dem__speed_to_wall(dem_world *w, const dem__wall_test *t, int *most) {
    double *relied = &w->engine->bodies.wall_speed[t->i],
           speed = dem__length(t->v) + 2.0 * w->engine->bodies.bound[t->i].tolerance;
    if (speed < 0.5 * *relied) *relied = 1.25 * speed;
    speed = (speed > *relied ? speed : *relied) + t->wall->speed_bound;
    *most = DEM__STEPS_MAX;
    if (!(t->wall->spin_bound > 0.0)) return speed;
    /* the surface is faster further out, where the particle may be at the next test */
    const double turn = DEM__RETEST_STEPS * w->engine->run.dt,
                 out = turn * (speed + turn * w->engine->pairs.gravity_size);
    *most = DEM__RETEST_STEPS;
    return speed + t->wall->spin_bound * (dem__arm(t->wall, t->x) + out);
}

/* Sets timer e to the next step in which the particle may touch the wall at another place. */
static inline void dem__wait_for_wall(dem_world *w, const dem__wall_test *t, int32_t e, int64_t step) {
    const dem__pairs *pairs = &w->engine->pairs;
    const double crossing = w->engine->run.has_periodic ? dem__far_from_faces(w, t->wall, t->x) : HUGE_VAL,
                 way = crossing < t->clear ? crossing : t->clear;
    int most, better = 0;
    const double speed = dem__speed_to_wall(w, t, &most);
    const int sure =
                  dem__steps_until(w, dem__time_to_cover(way - pairs->position_tolerance, speed, pairs->gravity_size)),
              steps = sure < most ? sure : most;
    if (steps < DEM__RETEST_STEPS / 4 && crossing == HUGE_VAL) better = dem__steps_until(w, dem__time_to_wall(w, t));
    w->engine->walls.sure[e] = (uint32_t)(uint64_t)(step + steps);
    dem__set_timer(&w->engine->walls.timers, e, step + (better > steps ? better : steps));
}

/* Tests the particle and the wall of timer e, at a step to which the wall has been moved. Begins contacts, or sets the
   timer. */
static inline void dem__test_wall(dem_world *w, int32_t e, int64_t step) {
    const int skips = w->def.skip & DEM_SKIP_SPACE;
    dem__wall_test t;
    t.i = e / w->walls, t.k = (int)(e % w->walls), t.wall = &w->wall[t.k];
    w->looks++;
    if (!w->alive[t.i] || !dem__is_at_wall(w, t.i, t.k)) return;
    const double tau = (double)(step - w->particle[t.i].origin) * w->engine->run.dt, radius = w->particle[t.i].radius;
    t.x = dem__at(w, t.i, tau), t.v = dem__velocity_at(w, t.i, tau);
    if (w->engine->run.has_periodic)
        t.x = dem__in_box(w, t.x); /* where the step will put it: a bar is known by its place */
    t.others = w->engine->pairs.wall_reach;
    t.found = dem__touch_wall(t.wall, t.x, radius, skips ? t.others : w->engine->pairs.touch_gap, t.touch, &t.clear);
    if (!dem__has_surface(t.wall) && t.clear < 0.0) {
        dem__test_exit(w, &t, e, step);
        return;
    }
    if (dem__has_surface(t.wall) && t.found > 0 && !dem__begin_at_wall(w, &t)) return;
    if (skips) dem__wait_for_wall(w, &t, e, step);
}
