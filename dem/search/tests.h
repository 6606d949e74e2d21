/* Tests: they find that a contact begins, or the next step in which one is possible. New contacts are appended to the
   last chunk. Relies on search/timers.h and walls/kinds.h. */
#pragma once
#include "../base/parallel.h"
#include "timers.h"
#include "../walls/exits.h"

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

/* Tests pair p: adds it to the pairs found if it touches, else to those whose timers are to be set. */
DEM_INLINE void dem__test_pair(dem_world *w, dem__timer_batch *waits, int32_t p, int64_t step, int rigid) {
    const dem__near *q = &w->engine->pairs.near[p];
    const dem_vec d = rigid ? dem__pair_separation(w, q->i, q->j, step) : dem__sphere_separation(w, q->i, q->j, step);
    waits->looks++;
    if (dem__dot(d, d) < q->distance * q->distance) waits->found[waits->touch++] = p;
    else if (w->def.skip & DEM_SKIP_PAIRS) dem__batch_separation(w, waits, p, step, d);
}

/* Begins the contacts that tests of pairs have found. Allocates memory for all of them at once. */
static inline void dem__new_pair_contacts(dem_world *w, const dem__timer_batch *waits) {
    dem__pairs *pairs = &w->engine->pairs;
    const ptrdiff_t slots = dem__next_slot(w) + waits->touch;
    w->looks += waits->looks;
    if (!dem__grow_contacts(w, slots > w->engine->contacts.capacity ? slots + slots / 2 : slots))
        w->status = DEM_OUT_OF_MEMORY;
    for (const int32_t *p = waits->found; p < waits->found + waits->touch && w->status == DEM_OK; p++) {
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

/* Returns the link after k in particle i's list; -1 at its end. */
DEM_INLINE int32_t dem__next_link(const dem_world *w, int32_t k, ptrdiff_t i) {
    const dem__links *links = &w->engine->links;
    return links->i[k] == i ? links->next_i[k] : links->next_j[k];
}

/* Returns the link of particle i with body j (a wall: -1 - index) at an element of it, or -1. */
static inline int32_t dem__link_of(const dem_world *w, ptrdiff_t i, ptrdiff_t j, int32_t element) {
    const dem__links *links = &w->engine->links;
    int32_t k = links->first_link[i];
    while (k >= 0) {
        const int first = links->i[k] == i;
        if ((first ? links->j[k] : links->i[k]) == j && (j >= 0 || links->element[k] == element)) return k;
        k = dem__next_link(w, k, i);
    }
    return -1;
}

/* Returns an arm [m]: no point of a wall at x is faster than speed_bound + arm * spin_bound. */
DEM_INLINE double dem__arm(const dem_wall *wall, dem_vec x) {
    const double arm =
        dem__length(dem__sub(x, wall->position)); /* a kinematic wall's speed_bound leaves out that its origin turns */
    return wall->asked.drive == DEM_KINEMATIC ? arm + dem__length(dem__sub(wall->asked.origin, wall->asked.spin_centre))
                                              : arm;
}

/* Returns whether particle i must be tested with a wall. A screen may be touched at several bars. Any other wall that
   it touches needs no test: it has one place, and dem__follow_meshes finds the other places of a mesh. */
DEM_INLINE int dem__needs_test(const dem_world *w, ptrdiff_t i, int wall) {
    if (dem__is_fixed(w, i)) return 0;
    if (dem__shape_of(w, i))
        return w->wall[wall].kind == DEM_EXIT; /* others: by corners and edges, in polyhedra/pairs.h */
    if (w->wall[wall].kind == DEM_SCREEN) return 1;
    for (int32_t c = w->engine->walls.first_contact[i]; c >= 0; c = w->engine->contacts.wall_next[c]) {
        if (w->engine->contacts.j[c] == -1 - wall) return 0;
    }
    return 1;
}

/* Returns whether the contact in slot c is one of a polyhedron. The functions after it read and write what a contact
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
DEM_INLINE dem__footing dem__footing_of(const dem_world *w, ptrdiff_t c) {
    double *const *place = w->engine->contacts.touch;
    dem__footing f;
    f.at = dem__place_vec(w, DEM__PLACE_FOOTING, c);
    f.slack = place[DEM__PLACE_SLACK][c], f.face = (int32_t)place[DEM__PLACE_FACE][c];
    return f;
}
DEM_INLINE void dem__set_footing(dem_world *w, ptrdiff_t c, const dem__footing *f) {
    double *const *place = w->engine->contacts.touch;
    dem__set_place_vec(w, DEM__PLACE_FOOTING, c, f->at);
    place[DEM__PLACE_SLACK][c] = f->slack, place[DEM__PLACE_FACE][c] = (double)f->face;
}
/* Moves the contact in slot c to a place of its mesh. */
DEM_INLINE void dem__set_touch(dem_world *w, ptrdiff_t c, const dem__touch *touch) {
    dem__set_place_vec(w, DEM__PLACE_NORMAL, c, touch->normal);
    w->engine->contacts.touch[DEM__PLACE_GAP][c] = touch->gap;
}

/* Begins a contact with a wall. A cone is touched from both sides and at its rims: a contact keeps the curvature with
   which it began. Returns 0 when out of memory. */
static inline int dem__new_wall_contact(dem_world *w, ptrdiff_t i, int wall, const dem__touch *touch, int32_t element) {
    dem__contacts *contacts = &w->engine->contacts;
    if (!dem__new_contact(w, i, -1 - wall, element, -1)) return 0;
    const ptrdiff_t c = dem__next_slot(w) - 1;
    if (w->wall[wall].kind == DEM_CONE) contacts->touch[DEM__CONE_CURVATURE][c] = touch->curvature;
    if (w->wall[wall].kind != DEM_MESH) return 1;
    dem__set_touch(w, c, touch);
    contacts->touch[DEM__PLACE_SLACK][c] = 0.0; /* no footing yet */
    dem__set_place_vec(w, DEM__PLACE_BEFORE, c, touch->normal);
    return 1;
}

/* Lists the contacts of particle i with wall k in the order of elements. Returns their number, at most DEM__NUMBERS. */
DEM_INLINE int dem__contacts_at(const dem_world *w, ptrdiff_t i, int k, int32_t *slot) {
    const dem__contacts *contacts = &w->engine->contacts;
    int n = 0;
    for (int32_t c = w->engine->walls.first_contact[i]; c >= 0 && n < DEM__NUMBERS; c = contacts->wall_next[c]) {
        if (contacts->j[c] != -1 - k) continue;
        int q = n++;
        for (; q > 0 && contacts->element[slot[q - 1]] > contacts->element[c]; q--) slot[q] = slot[q - 1];
        slot[q] = c;
    }
    return n;
}

/* Where particle i touches mesh k. */
typedef struct dem__mesh_places {
    dem__touch touch[DEM__TOUCHES];
    int n, taken, used; /* number of places; bits: places that have a contact, elements of the contacts */
} dem__mesh_places;

/* Moves the contacts of particle i with mesh k, in the listed slots, to a step to which the wall has been moved. Each
   continues at the deepest place whose normal is near its own, or ends. Returns the places; none if the only contact
   rests on its footing. */
static inline void dem__match_places(dem_world *w, ptrdiff_t i, int k, const int32_t *slot, int slots, int64_t step,
                                     dem__mesh_places *at) {
    dem__contacts *contacts = &w->engine->contacts;
    const dem_wall *wall = &w->wall[k];
    const double tau = (double)(step - w->particle[i].origin) * w->engine->run.dt;
    const dem_vec x = dem__at(w, i, tau), d = dem__sub(x, wall->position);
    const double speed =
        dem__length(dem__velocity_at(w, i, tau)) + wall->speed_bound + wall->spin_bound * dem__arm(wall, x);
    const double radius = w->particle[i].radius, near = w->engine->links.near,
                 leaves = 2.0 * w->engine->run.dt * speed, /* more than a contact opens in a step */
        deep = leaves > near ? leaves : near;
    dem__footing footing = dem__footing_of(w, slot[0]);
    double least;
    at->n = at->taken = at->used = 0;
    if (slots == 1 && dem__keeps_footing(wall, &footing, d, radius, deep, at->touch)) {
        dem__set_touch(w, slot[0], at->touch);
        return;
    }
    at->n = dem__touch_mesh(wall, d, radius, deep, radius, at->touch, &least);
    for (int m = 0; m < slots; m++) {
        const int32_t c = slot[m];
        int q = 0;
        at->used |= 1 << contacts->element[c];
        while (q < at->n &&
               ((at->taken >> q & 1) || !(dem__dot(at->touch[q].normal, dem__place_normal(w, c)) > DEM__SMOOTH)))
            q++;
        if (q == at->n) { /* merged with another: it ends without a force, whatever its depth */
            contacts->touch[DEM__PLACE_GAP][c] = w->particle[i].radius;
            contacts->force[c] = 0.0;
            continue;
        }
        at->taken |= 1 << q;
        dem__set_touch(w, c, &at->touch[q]);
    }
    footing.slack = 0.0;
    if (slots == 1 && at->n == 1 && at->taken) footing = dem__find_footing(wall, d, radius, at->touch);
    for (int m = 0; m < slots; m++) dem__set_footing(w, slot[m], &footing);
}

/* Returns whether place q touches and has no contact. */
DEM_INLINE int dem__is_place_left(const dem__mesh_places *at, int q) {
    return !(at->taken >> q & 1) && at->touch[q].gap < 0.0;
}
static inline int dem__are_places_left(const dem__mesh_places *at) {
    for (int q = 0; q < at->n; q++) {
        if (dem__is_place_left(at, q)) return 1;
    }
    return 0;
}

/* Begins contacts of particle i with mesh k at the places that are left, as long as there are free elements. */
static inline void dem__begin_at_places(dem_world *w, ptrdiff_t i, int k, dem__mesh_places *at) {
    for (int q = 0; q < at->n; q++) {
        int32_t element = 0;
        if (!dem__is_place_left(at, q)) continue;
        while (at->used >> element & 1) element++;
        if (element == DEM__NUMBERS) return;
        at->used |= 1 << element;
        if (!dem__new_wall_contact(w, i, k, &at->touch[q], element)) return;
    }
}

/* Lists the contacts of a particle with a mesh if slot c holds the first of them. Returns their number, otherwise 0. */
static inline int dem__contacts_at_mesh(const dem_world *w, ptrdiff_t c, int32_t *slot) {
    const int k = -1 - (int)w->engine->contacts.j[c];
    if (k < 0 || w->wall[k].kind != DEM_MESH || dem__is_convex_contact(w, c))
        return 0; /* those of a polyhedron follow its points */
    const int slots = dem__contacts_at(w, w->engine->contacts.i[c], k, slot);
    return slots > 0 && slot[0] == c ? slots : 0;
}

/* Moves the contacts of chunks first .. end-1. Notes in contacts.edge, which is free before the kernel, where places
   are left: contacts begin on one thread. */
static inline void dem__find_followers(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *step) {
    dem__contacts *contacts = &w->engine->contacts;
    (void)part;
    for (const dem__chunk *in = contacts->chunk + first; in < contacts->chunk + end; in++) {
        for (ptrdiff_t c = in->first; c < in->first + in->count; c++) {
            int32_t slot[DEM__NUMBERS];
            dem__mesh_places at;
            const int slots = dem__contacts_at_mesh(w, c, slot);
            contacts->edge[c] = 0;
            if (slots == 0) continue;
            for (int m = 0; m < slots; m++)
                dem__set_place_vec(w, DEM__PLACE_BEFORE, slot[m], dem__place_normal(w, slot[m]));
            dem__match_places(w, contacts->i[c], -1 - (int)contacts->j[c], slot, slots, *(const int64_t *)step, &at);
            contacts->edge[c] = (uint8_t)dem__are_places_left(&at);
        }
    }
}

/* Moves contacts with meshes to a step to which the walls have been moved, and begins those at other places of meshes
   that particles touch already. */
static inline void dem__follow_meshes(dem_world *w, int64_t step) {
    const dem__contacts *contacts = &w->engine->contacts;
    const ptrdiff_t end = dem__next_slot(w);
    dem__in_parts(w, dem__parts_of(w, contacts->count, contacts->chunk_count), contacts->chunk_count,
                  dem__find_followers, &step);
    DEM__EACH_CONTACT(w, c) {
        int32_t slot[DEM__NUMBERS];
        dem__mesh_places at;
        if (c >= end || !contacts->edge[c] || w->status != DEM_OK) continue;
        const ptrdiff_t i = contacts->i[c];
        const int k = -1 - (int)contacts->j[c], slots = dem__contacts_at_mesh(w, c, slot);
        dem__match_places(w, i, k, slot, slots, step, &at);
        dem__begin_at_places(w, i, k, &at);
    }
}

/* Returns whether a point is beyond an exit. A rigid body leaves when its centre of mass is, and the centre of one of
   its particles. */
static inline int dem__has_passed(const dem_wall *wall, dem_vec x) {
    return dem__dot(dem__sub(x, wall->position), wall->axis[2]) < 0.0;
}

/* Returns an acceleration [m/s2]: on a straight path at u, from_axis [m] off a wall's axis, the distance from the axis
   grows by no more than the outward velocity and this acceleration give: u_side^2 / from_axis. */
DEM_INLINE double dem__bend(const dem_wall *wall, dem_vec u, double from_axis) {
    const double along = dem__dot(u, wall->axis[2]);
    return from_axis > 0.0 ? (dem__dot(u, u) - along * along) / from_axis : HUGE_VAL;
}

/* Returns a lower limit of the gap of bars that are not among those found [m]. */
static inline double dem__other_bars(const dem_world *w, const dem_wall *wall, double radius, const dem__touch *touch,
                                     int found) {
    double lowest = 0.0;
    for (int q = 0; q < found; q++) lowest = touch[q].gap < lowest ? touch[q].gap : lowest;
    const double third = dem__third_bar(wall, radius, lowest);
    return third < w->engine->pairs.wall_reach ? third : w->engine->pairs.wall_reach;
}

/* Returns how far x is from a face of the periodic box beyond which the wall does not continue [m]: walls are not
   repeated. */
static inline double dem__far_from_faces(const dem_world *w, const dem_wall *wall, dem_vec x) {
    double least = HUGE_VAL;
    for (int a = 0; a < 3; a++) {
        const double along = fabs(dem_axis(wall->axis[2], a)), at = dem_axis(x, a);
        const int flat = (wall->kind == DEM_PLANE || wall->kind == DEM_EXIT) && along == 0.0,
                  tube = wall->kind == DEM_CYLINDER && along == 1.0;
        if (!w->def.periodic[a] || (wall->spin_bound == 0.0 && (flat || tube))) continue;
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
    double others; /* the same of what is not among the places found */
    int found;
    dem__touch touch[DEM__TOUCHES];
} dem__wall_test;

/* Returns a time [s] before which the particle cannot touch the wall, from its velocity and the tolerance of its bound;
   0 if none is known. Near a wall it is longer than the time from speeds alone, but it holds for this bound only. A
   plane, a bar and a cylinder from outside are convex, so that a gap cannot shrink faster than along its normal. */
static inline double dem__time_to_wall(const dem_world *w, const dem__wall_test *t) {
    const dem_wall *wall = t->wall;
    const double stray = 2.0 * w->engine->bodies.bound[t->i].tolerance,
                 near = w->engine->links.near + w->engine->pairs.position_tolerance, radius = w->particle[t->i].radius;
    const dem_vec u = dem__sub(t->v, wall->velocity), g = dem__free_fall(w);
    double a = w->engine->pairs.gravity_size + wall->acceleration_bound, least = HUGE_VAL;
    if (t->found == 0 || wall->asked.drive != DEM_KINEMATIC || wall->kind > DEM_EXIT || wall->spin != 0.0 ||
        !(a < HUGE_VAL))
        return 0.0;
    if (wall->kind == DEM_SCREEN) least = dem__time_to_close(t->others - near, dem__length(u) + stray, a);
    if (wall->kind == DEM_CYLINDER) {
        const double along = dem__dot(g, wall->axis[2]), from_axis = wall->radius - radius - t->touch->gap;
        a = sqrt(fabs(dem__dot(g, g) - along * along)) + wall->side_bound;
        if (wall->inside) a += dem__bend(wall, u, from_axis);
    }
    for (int q = 0; q < t->found; q++) {
        if (wall->kind != DEM_EXIT && dem__touches_element(w, t->i, t->k, t->touch[q].element)) continue;
        const double time = dem__time_to_close(t->touch[q].gap - near, stray - dem__dot(u, t->touch[q].normal), a);
        least = time < least ? time : least;
    }
    return least;
}

/* Lets a particle beyond an exit leave. A rigid body whose centre is not beyond it is tested again in the next step. */
static inline void dem__test_exit(dem_world *w, const dem__wall_test *t, int32_t e, int64_t step) {
    const dem__rigid *r = dem__rigid_of(w, t->i);
    const double tau = (double)(step - w->particle[t->i].origin) * w->engine->run.dt;
    if (!r || dem__has_passed(t->wall, dem__in_box(w, dem__posture_at(w, r, tau).x))) dem__pass_exit(w, t->i, t->k);
    else if (w->def.skip & DEM_SKIP_SPACE) dem__set_timer(&w->engine->walls.timers, e, step + 1);
}

/* Begins contacts at the places found, and sets what is clear of them. Returns 0 if the wall needs no other test: it is
   touched at its only place, or memory ran out. */
static inline int dem__begin_at_wall(dem_world *w, dem__wall_test *t) {
    const double near = w->engine->links.near;
    int touches = 0;
    if (t->wall->kind == DEM_SCREEN)
        t->others = dem__other_bars(w, t->wall, w->particle[t->i].radius, t->touch, t->found);
    t->clear = t->others;
    for (int q = 0; q < t->found; q++) {
        const dem__touch *place = &t->touch[q];
        if (dem__touches_element(w, t->i, t->k, place->element)) continue;
        const int linked = place->gap < near && dem__link_of(w, t->i, -1 - t->k, place->element) >= 0;
        if (place->gap < (linked ? near : 0.0)) {
            if (!dem__new_wall_contact(w, t->i, t->k, place, place->element)) return 0;
            touches = 1;
        } else t->clear = place->gap - near < t->clear ? place->gap - near : t->clear;
    }
    return !touches || t->wall->kind == DEM_SCREEN;
}

/* Returns a limit of the speed at which particle and wall approach each other now [m/s]. most: number of steps for
   which it holds if gravity is added. */
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

/* Tests the particle and the wall of timer e, at a step to which the wall has been moved: begins contacts, or sets the
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
        t.x = dem__in_box(w, t.x); /* where the step will put it: bars are told apart by their place */
    t.others = w->engine->pairs.wall_reach;
    t.found = dem__touch_wall(t.wall, t.x, radius, skips ? t.others : w->engine->links.near, t.touch, &t.clear);
    if (t.wall->kind == DEM_EXIT && t.clear < 0.0) {
        dem__test_exit(w, &t, e, step);
        return;
    }
    if (t.wall->kind != DEM_EXIT && t.found > 0 && !dem__begin_at_wall(w, &t)) return;
    if (skips) dem__wait_for_wall(w, &t, e, step);
}
