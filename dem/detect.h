/* Every contact: DEM__EACH(w, c) { .. slot c .. }; break leaves a section only. */
#define DEM__EACH(w, c)                                                                                                                    \
    for (const dem__section *in_##c = (w)->section__; in_##c < (w)->section__ + (w)->sections__; in_##c++)                                 \
        for (ptrdiff_t c = in_##c->first; c < in_##c->first + in_##c->live; c++)

/* Contacts are numbered from 0 for others, in the order of slots: the slot of contact k, the number of that in a slot. */
DEM_INLINE ptrdiff_t dem__slot_of(const dem_world *w, ptrdiff_t k) {
    const dem__section *in = w->section__;
    while (k >= in->live) k -= in++->live;
    return in->first + k;
}
DEM_INLINE int32_t dem__number_of(const dem_world *w, ptrdiff_t c) {
    const dem__section *in = w->section__;
    ptrdiff_t before = 0;
    while (c >= in->first + in->live) before += in++->live;
    return (int32_t)(before + c - in->first);
}

/* Where the next contact is born. */
DEM_INLINE ptrdiff_t dem__next_slot(const dem_world *w) {
    const dem__section *last = &w->section__[w->sections__ - 1];
    return last->first + last->live;
}

static inline int dem__grow_live(dem_world *w, ptrdiff_t slots) {
    dem__array list[DEM__ARRAYS_MAX];
    return slots <= w->live_capacity__ || (slots <= INT32_MAX / 2 && dem__grow_group(w, list, dem__live_arrays(w, list), &w->live_block__,
                                                                                     &w->live_bytes__, &w->live_capacity__, slots));
}

/* A new contact, in the next slot; made ready in dem__admit_born. */
static inline int dem__bear(dem_world *w, ptrdiff_t i, ptrdiff_t j, int32_t element, int32_t near_pair) {
    const ptrdiff_t c = dem__next_slot(w);
    if (!dem__grow_live(w, c + 1)) {
        w->status = DEM_OUT_OF_MEMORY;
        return 0;
    }
    w->live_count__++;
    w->section__[w->sections__ - 1].live++;
    w->live_i__[c] = (int32_t)i;
    w->live_j__[c] = (int32_t)j;
    w->live_element__[c] = element;
    w->live_near__[c] = near_pair;
    w->born__++;
    return 1;
}

/* Looks at a pair: it is found, or its timer is to be set. */
static inline void dem__look_at_pair(dem_world *w, dem__waits *waits, int32_t p, int64_t step) {
    const dem__near *q = &w->near__[p];
    const dem_vec d = dem__pair_apart(w, q->i, q->j, step);
    waits->looks++;
    if (dem__dot(d, d) < q->distance * q->distance) waits->found[waits->touch++] = p;
    else if (w->def.skip & DEM_SKIP_PAIRS) dem__wait_from(w, waits, p, step, d);
}

/* Makes contacts of what looks have found. Room for many is made at once. */
static inline void dem__bear_found(dem_world *w, const dem__waits *waits) {
    const ptrdiff_t slots = dem__next_slot(w) + waits->touch;
    w->looks += waits->looks;
    if (!dem__grow_live(w, slots > w->live_capacity__ ? slots + slots / 2 : slots)) w->status = DEM_OUT_OF_MEMORY;
    for (const int32_t *p = waits->found; p < waits->found + waits->touch && w->status == DEM_OK; p++) {
        if (dem__bear(w, w->near__[*p].i, w->near__[*p].j, 0, *p)) dem__stop_timer(&w->pair_timers__, *p);
    }
}

static inline int dem__touches_element(const dem_world *w, ptrdiff_t i, int wall, int32_t element) {
    for (int32_t c = w->wall_head__[i]; c >= 0; c = w->live_wall_next__[c]) {
        if (w->live_j__[c] == -1 - wall && w->live_element__[c] == element) return 1;
    }
    return 0;
}

/* After link k in particle i's list; -1 at its end. */
DEM_INLINE int32_t dem__next_link(const dem_world *w, int32_t k, ptrdiff_t i) {
    return w->link_i__[k] == i ? w->link_next_i__[k] : w->link_next_j__[k];
}

/* The link of particle i with body j (a wall: -1 - index) at an element of it, or -1. */
static inline int32_t dem__link_of(const dem_world *w, ptrdiff_t i, ptrdiff_t j, int32_t element) {
    int32_t k = w->link_head__[i];
    while (k >= 0) {
        const int first = w->link_i__[k] == i;
        if ((first ? w->link_j__[k] : w->link_i__[k]) == j && (j >= 0 || w->link_element__[k] == element)) return k;
        k = dem__next_link(w, k, i);
    }
    return -1;
}

/* No point of a wall at x is faster than speed_bound + spin_bound times this. */
DEM_INLINE double dem__arm(const dem_wall *wall, dem_vec x) {
    const double arm = dem__length(dem__sub(x, wall->position)); /* a kinematic wall's origin turns as well, beside its speed bound */
    return wall->drive == DEM_KINEMATIC ? arm + dem__length(dem__sub(wall->origin, wall->spin_centre)) : arm;
}

/* Is there anything to look for between particle i and a wall? Of a screen another bar; of the others not while they touch: a wall has no
   second place, and what else a mesh has is found by dem__follow. */
DEM_INLINE int dem__awaits(const dem_world *w, ptrdiff_t i, int wall) {
    if (w->wall[wall].kind == DEM_SCREEN) return 1;
    for (int32_t c = w->wall_head__[i]; c >= 0; c = w->live_wall_next__[c]) {
        if (w->live_j__[c] == -1 - wall) return 0;
    }
    return 1;
}

/* A contact with a place of a wall. That of a cone, which is touched from both sides and at its rims, keeps the curvature of its
   beginning. */
static inline int dem__bear_at_wall(dem_world *w, ptrdiff_t i, int wall, const dem__touch *touch, int32_t element) {
    if (!dem__bear(w, i, -1 - wall, element, -1)) return 0;
    const ptrdiff_t c = dem__next_slot(w) - 1;
    if (w->wall[wall].kind == DEM_CONE) w->live_place__[0][c] = touch->curvature;
    if (w->wall[wall].kind != DEM_MESH) return 1;
    w->live_place__[0][c] = touch->normal.x, w->live_place__[1][c] = touch->normal.y, w->live_place__[2][c] = touch->normal.z;
    w->live_place__[3][c] = touch->gap;
    return 1;
}

/* The contacts of particle i with wall k, by element; how many. */
DEM_INLINE int dem__contacts_at(const dem_world *w, ptrdiff_t i, int k, int32_t *slot) {
    int n = 0;
    for (int32_t c = w->wall_head__[i]; c >= 0 && n < DEM__NUMBERS; c = w->live_wall_next__[c]) {
        if (w->live_j__[c] != -1 - k) continue;
        int q = n++;
        for (; q > 0 && w->live_element__[slot[q - 1]] > w->live_element__[c]; q--) slot[q] = slot[q - 1];
        slot[q] = c;
    }
    return n;
}

/* The contacts of particle i with mesh k to a step at which the wall already is: each goes on at the deepest place whose normal is near
   its own, or ends. Are there places left for new ones? */
static inline int dem__follow_mesh(dem_world *w, ptrdiff_t i, int k, const int32_t *slot, int slots, int64_t step, int bear) {
    const dem_wall *wall = &w->wall[k];
    const double tau = (double)(step - w->particle[i].origin) * w->dt__;
    const dem_vec x = dem__at(w, i, tau), d = dem__sub(x, wall->position);
    const double speed = dem__length(dem__velocity_at(w, i, tau)) + wall->speed_bound + wall->spin_bound * dem__arm(wall, x);
    double **place = w->live_place__, least;
    dem__touch touch[DEM__TOUCHES];
    int n, taken = 0, used = 0, left = 0;
    const double leaves = 2.0 * w->dt__ * speed; /* as far as a contact can open in a step */
    n = dem__touch_mesh(wall, d, w->particle[i].radius, leaves > w->link_near__ ? leaves : w->link_near__, w->particle[i].radius, touch,
                        &least);
    for (int m = 0; m < slots; m++) {
        const int32_t c = slot[m];
        int q = 0;
        used |= 1 << w->live_element__[c];
        while (q < n &&
               ((taken >> q & 1) ||
                !(touch[q].normal.x * place[0][c] + touch[q].normal.y * place[1][c] + touch[q].normal.z * place[2][c] > DEM__SMOOTH)))
            q++;
        if (q == n) { /* merged with another, at whatever depth: no force goes on */
            place[3][c] = w->particle[i].radius;
            w->live_force__[c] = 0.0;
            continue;
        }
        taken |= 1 << q;
        place[0][c] = touch[q].normal.x, place[1][c] = touch[q].normal.y, place[2][c] = touch[q].normal.z;
        place[3][c] = touch[q].gap;
    }
    for (int q = 0; q < n; q++) {
        int32_t free_number = 0;
        if ((taken >> q & 1) || !(touch[q].gap < 0.0)) continue;
        left = 1;
        while (used >> free_number & 1) free_number++;
        if (free_number == DEM__NUMBERS) break;
        used |= 1 << free_number;
        if (bear && !dem__bear_at_wall(w, i, k, &touch[q], free_number)) break;
    }
    return left;
}

/* Follows the contacts with a mesh of which slot c holds the first; of other contacts does nothing. */
static inline int dem__follow_slot(dem_world *w, ptrdiff_t c, int64_t step, int bear) {
    const ptrdiff_t i = w->live_i__[c];
    const int k = -1 - (int)w->live_j__[c];
    int32_t slot[DEM__NUMBERS];
    if (k < 0 || w->wall[k].kind != DEM_MESH) return 0;
    const int slots = dem__contacts_at(w, i, k, slot);
    return slot[0] == c ? dem__follow_mesh(w, i, k, slot, slots, step, bear) : 0;
}

static inline void dem__find_followers(dem_world *w, int64_t step, ptrdiff_t first, ptrdiff_t end) {
    for (const dem__section *in = w->section__ + first; in < w->section__ + end; in++) {
        for (ptrdiff_t c = in->first; c < in->first + in->live; c++) w->live_event__[c] = (uint8_t)dem__follow_slot(w, c, step, 0);
    }
}

/* Contacts with meshes to a step at which the walls already are. */
static inline void dem__follow(dem_world *w, int64_t step) {
    const ptrdiff_t end = dem__next_slot(w), sections = w->sections__;
    const int parts = dem__parts_of(w, w->live_count__, w->sections__);
    int q;
    if (parts == 1) dem__find_followers(w, step, 0, sections);
    else {
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
        for (q = 0; q < parts; q++) dem__find_followers(w, step, dem__part(sections, q, parts), dem__part(sections, q + 1, parts));
    }
    DEM__EACH(w, c) {
        if (c < end && w->live_event__[c] && w->status == DEM_OK) dem__follow_slot(w, c, step, 1);
    }
}

static inline void dem__drop(dem_world *w, ptrdiff_t i, int wall);

/* A straight course at u, from a place d off the axis, leads no further out than d + u_out t + u_side^2 t^2/(2 d): this acceleration. */
DEM_INLINE double dem__bend(const dem_wall *wall, dem_vec u, double from_axis) {
    const double along = dem__dot(u, wall->axis[2]);
    return from_axis > 0.0 ? (dem__dot(u, u) - along * along) / from_axis : HUGE_VAL;
}

/* How near bars may be that are not among those found. */
static inline double dem__other_bars(const dem_world *w, const dem_wall *wall, double radius, const dem__touch *touch, int found) {
    double lowest = 0.0;
    for (int q = 0; q < found; q++) lowest = touch[q].gap < lowest ? touch[q].gap : lowest;
    const double third = dem__third_bar(wall, radius, lowest);
    return third < w->reach__ ? third : w->reach__;
}

/* Time before which particle i cannot touch a wall, by what is known of velocities: better than the bound by speeds alone near a wall, but
   only on this course. A plane, a bar and a cylinder from outside are convex, so that a gap cannot shrink faster than along its normal. */
static inline double dem__time_on_course(const dem_world *w, ptrdiff_t i, const dem_wall *wall, dem_vec v, int k, const dem__touch *touch,
                                         int found, double others) {
    const double stray = 2.0 * w->course__[i].ball, near = w->link_near__ + w->blur__, radius = w->particle[i].radius;
    const dem_vec u = dem__sub(v, wall->velocity), g = w->def.gravity;
    double a = w->fall__ + wall->acceleration_bound, least = HUGE_VAL;
    if (found == 0 || wall->drive != DEM_KINEMATIC || wall->kind > DEM_EXIT || wall->spin != 0.0 || !(a < HUGE_VAL)) return 0.0;
    if (wall->kind == DEM_SCREEN) least = dem__time_to_close(others - near, dem__length(u) + stray, a);
    if (wall->kind == DEM_CYLINDER) {
        const double along = dem__dot(g, wall->axis[2]), from_axis = wall->radius - radius - touch->gap;
        a = sqrt(fabs(dem__dot(g, g) - along * along)) + wall->side_bound;
        if (wall->inside) a += dem__bend(wall, u, from_axis);
    }
    for (int q = 0; q < found; q++) {
        if (wall->kind != DEM_EXIT && dem__touches_element(w, i, k, touch[q].element)) continue;
        const double t = dem__time_to_close(touch[q].gap - near, stray - dem__dot(u, touch[q].normal), a);
        least = t < least ? t : least;
    }
    return least;
}

/* How far it is from x to the face of the periodic box behind which the wall is another one: walls are not repeated. */
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

/* Looks at particle i and a wall at a step at which the wall already is. */
static inline void dem__look_at_wall(dem_world *w, int32_t e, int64_t step) {
    const ptrdiff_t i = e / w->walls;
    const int k = (int)(e % w->walls);
    int found, touches = 0;
    dem_wall *wall = &w->wall[k];
    w->looks++;
    if (!wall->enabled || !w->alive[i]) return;
    double tau = (double)(step - w->particle[i].origin) * w->dt__, least, others = w->reach__;
    dem_vec x = dem__at(w, i, tau), v = dem__velocity_at(w, i, tau);
    if (w->has_periodic__) x = dem__in_box(w, x); /* where the step will put it: bars are told apart by their place */
    dem__touch touch[DEM__TOUCHES];
    found = dem__touch_wall(wall, x, w->particle[i].radius, w->def.skip & DEM_SKIP_SPACE ? w->reach__ : w->link_near__, touch, &least);
    if (wall->kind == DEM_EXIT) {
        if (least < 0.0) {
            dem__drop(w, i, k);
            return;
        }
    } else if (found > 0) {
        if (wall->kind == DEM_SCREEN) others = dem__other_bars(w, wall, w->particle[i].radius, touch, found);
        least = others;
        for (int q = 0; q < found; q++) {
            if (dem__touches_element(w, i, k, touch[q].element)) continue;
            const int linked = touch[q].gap < w->link_near__ && dem__link_of(w, i, -1 - k, touch[q].element) >= 0;
            if (touch[q].gap < (linked ? w->link_near__ : 0.0)) {
                if (!dem__bear_at_wall(w, i, k, &touch[q], touch[q].element)) return;
                touches = 1;
            } else least = touch[q].gap - w->link_near__ < least ? touch[q].gap - w->link_near__ : least;
        }
        if (touches && wall->kind != DEM_SCREEN) return;
    }
    if (!(w->def.skip & DEM_SKIP_SPACE)) return;
    const double crossing = w->has_periodic__ ? dem__far_from_faces(w, wall, x) : HUGE_VAL;
    least = crossing < least ? crossing : least;
    double speed = dem__length(v) + 2.0 * w->course__[i].ball;
    if (speed < 0.5 * w->wall_speed__[i]) w->wall_speed__[i] = 1.25 * speed;
    speed = (speed > w->wall_speed__[i] ? speed : w->wall_speed__[i]) + wall->speed_bound;
    int most = DEM__FAR;
    if (wall->spin_bound > 0.0) { /* the surface is faster further out, where the particle may be at the next look */
        const double turn = DEM__OFTEN * w->dt__, out = turn * (speed + turn * w->fall__);
        speed += wall->spin_bound * (dem__arm(wall, x) + out);
        most = DEM__OFTEN;
    }
    const int sure = dem__steps_until(w, dem__time_to_cover(least - w->blur__, speed, w->fall__)), steps = sure < most ? sure : most;
    int better = 0;
    if (steps < DEM__OFTEN / 4 && crossing == HUGE_VAL)
        better = dem__steps_until(w, dem__time_on_course(w, i, wall, v, k, touch, found, others));
    w->wall_sure__[e] = (uint32_t)(uint64_t)(step + steps);
    dem__set_timer(&w->wall_timers__, e, step + (better > steps ? better : steps));
}
