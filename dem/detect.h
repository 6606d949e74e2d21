/* Tests: they find that a contact begins, or the next step in which one is possible. New contacts are appended to the last chunk. Relies on
   timers.h and wall_shapes.h.
   May be changed here alone: how soon a test is repeated; never later than a contact is possible. */

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
           (slots <= INT32_MAX / 2 &&
            dem__grow_group(w, list, dem__contact_arrays(w, list), &contacts->block, &contacts->bytes, &contacts->capacity, slots));
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
    if (!dem__grow_contacts(w, slots > w->engine->contacts.capacity ? slots + slots / 2 : slots)) w->status = DEM_OUT_OF_MEMORY;
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
    const double arm = dem__length(dem__sub(x, wall->position)); /* a kinematic wall's speed_bound leaves out that its origin turns */
    return wall->asked.drive == DEM_KINEMATIC ? arm + dem__length(dem__sub(wall->asked.origin, wall->asked.spin_centre)) : arm;
}

/* Returns whether particle i must be tested with a wall. A screen may be touched at several bars. Any other wall that it touches needs no
   test: it has one place, and dem__follow_meshes finds the other places of a mesh. */
DEM_INLINE int dem__needs_test(const dem_world *w, ptrdiff_t i, int wall) {
    if (dem__is_fixed(w, i)) return 0;
    if (dem__shape_of(w, i)) return w->wall[wall].kind == DEM_EXIT; /* others: by corners and edges, in convex_pairs.h */
    if (w->wall[wall].kind == DEM_SCREEN) return 1;
    for (int32_t c = w->engine->walls.first_contact[i]; c >= 0; c = w->engine->contacts.wall_next[c]) {
        if (w->engine->contacts.j[c] == -1 - wall) return 0;
    }
    return 1;
}

/* Returns whether the contact in slot c is one of a polyhedron. The functions after it read and write what a contact keeps of the place
   where it touches: see DEM__PLACE_NORMAL in engine.h. first: the first of three numbers. */
DEM_INLINE int dem__is_convex_contact(const dem_world *w, ptrdiff_t c) { return w->engine->contacts.near[c] < -1; }
DEM_INLINE dem_vec dem__place_vec(const dem_world *w, int first, ptrdiff_t c) {
    double *const *place = &w->engine->contacts.touch[first];
    return dem_vec3(place[0][c], place[1][c], place[2][c]);
}
DEM_INLINE void dem__set_place_vec(dem_world *w, int first, ptrdiff_t c, dem_vec v) {
    double *const *place = &w->engine->contacts.touch[first];
    place[0][c] = v.x, place[1][c] = v.y, place[2][c] = v.z;
}
DEM_INLINE dem_vec dem__place_normal(const dem_world *w, ptrdiff_t c) { return dem__place_vec(w, DEM__PLACE_NORMAL, c); }
DEM_INLINE dem_vec dem__place_before(const dem_world *w, ptrdiff_t c) { return dem__place_vec(w, DEM__PLACE_BEFORE, c); }
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

/* Begins a contact with a wall. A cone is touched from both sides and at its rims: a contact keeps the curvature with which it began.
   Returns 0 when out of memory. */
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

/* Moves the contacts of particle i with mesh k to a step to which the wall has been moved. Each continues at the deepest place whose normal
   is near its own, or ends. bear: whether contacts begin at the remaining places. Returns whether places are left. */
static inline int dem__follow_mesh(dem_world *w, ptrdiff_t i, int k, const int32_t *slot, int slots, int64_t step, int bear) {
    dem__contacts *contacts = &w->engine->contacts;
    const dem_wall *wall = &w->wall[k];
    const double tau = (double)(step - w->particle[i].origin) * w->engine->run.dt;
    const dem_vec x = dem__at(w, i, tau), d = dem__sub(x, wall->position);
    const double speed = dem__length(dem__velocity_at(w, i, tau)) + wall->speed_bound + wall->spin_bound * dem__arm(wall, x);
    double least;
    dem__touch touch[DEM__TOUCHES];
    int n, taken = 0, used = 0, left = 0;
    const double radius = w->particle[i].radius, near = w->engine->links.near,
                 leaves = 2.0 * w->engine->run.dt * speed, /* more than a contact opens in a step */
        deep = leaves > near ? leaves : near;
    dem__footing footing = dem__footing_of(w, slot[0]);
    for (int m = 0; m < slots && !bear; m++) { /* with `bear` this has been done in this step */
        dem__set_place_vec(w, DEM__PLACE_BEFORE, slot[m], dem__place_normal(w, slot[m]));
    }
    if (slots == 1 && dem__keeps_footing(wall, &footing, d, radius, deep, touch)) {
        dem__set_touch(w, slot[0], touch);
        return 0;
    }
    n = dem__touch_mesh(wall, d, radius, deep, radius, touch, &least);
    for (int m = 0; m < slots; m++) {
        const int32_t c = slot[m];
        int q = 0;
        used |= 1 << contacts->element[c];
        while (q < n && ((taken >> q & 1) || !(dem__dot(touch[q].normal, dem__place_normal(w, c)) > DEM__SMOOTH))) q++;
        if (q == n) { /* merged with another: it ends without a force, whatever its depth */
            contacts->touch[DEM__PLACE_GAP][c] = w->particle[i].radius;
            contacts->force[c] = 0.0;
            continue;
        }
        taken |= 1 << q;
        dem__set_touch(w, c, &touch[q]);
    }
    footing.slack = 0.0;
    if (slots == 1 && n == 1 && taken) footing = dem__find_footing(wall, d, radius, touch);
    for (int m = 0; m < slots; m++) dem__set_footing(w, slot[m], &footing);
    for (int q = 0; q < n; q++) {
        int32_t free_number = 0;
        if ((taken >> q & 1) || !(touch[q].gap < 0.0)) continue;
        left = 1;
        while (used >> free_number & 1) free_number++;
        if (free_number == DEM__NUMBERS) break;
        used |= 1 << free_number;
        if (bear && !dem__new_wall_contact(w, i, k, &touch[q], free_number)) break;
    }
    return left;
}

/* Moves a particle's contacts with a mesh if slot c holds the first of them; otherwise does nothing. Returns whether places for new
   contacts are left. */
static inline int dem__follow_slot(dem_world *w, ptrdiff_t c, int64_t step, int bear) {
    const ptrdiff_t i = w->engine->contacts.i[c];
    const int k = -1 - (int)w->engine->contacts.j[c];
    int32_t slot[DEM__NUMBERS];
    if (k < 0 || w->wall[k].kind != DEM_MESH || dem__is_convex_contact(w, c)) return 0; /* those of a polyhedron follow its points */
    const int slots = dem__contacts_at(w, i, k, slot);
    return slot[0] == c ? dem__follow_mesh(w, i, k, slot, slots, step, bear) : 0;
}

/* Moves the contacts of chunks first .. end-1. Notes in contacts.edge, which is free before the kernel, where places are left: contacts
   begin on one thread. */
static inline void dem__find_followers(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *step) {
    dem__contacts *contacts = &w->engine->contacts;
    (void)part;
    for (const dem__chunk *in = contacts->chunk + first; in < contacts->chunk + end; in++) {
        for (ptrdiff_t c = in->first; c < in->first + in->count; c++) {
            contacts->edge[c] = (uint8_t)dem__follow_slot(w, c, *(const int64_t *)step, 0);
        }
    }
}

/* Moves contacts with meshes to a step to which the walls have been moved. */
static inline void dem__follow_meshes(dem_world *w, int64_t step) {
    const dem__contacts *contacts = &w->engine->contacts;
    const ptrdiff_t end = dem__next_slot(w);
    dem__in_parts(w, dem__parts_of(w, contacts->count, contacts->chunk_count), contacts->chunk_count, dem__find_followers, &step);
    DEM__EACH_CONTACT(w, c) {
        if (c < end && contacts->edge[c] && w->status == DEM_OK) dem__follow_slot(w, c, step, 1);
    }
}

/* Returns whether a point is beyond an exit. A rigid body leaves when its centre of mass is, and the centre of one of its particles. */
static inline int dem__has_passed(const dem_wall *wall, dem_vec x) { return dem__dot(dem__sub(x, wall->position), wall->axis[2]) < 0.0; }

/* Returns an acceleration [m/s2]: on a straight path at u, from_axis [m] off a wall's axis, the distance from the axis grows by no more
   than the outward velocity and this acceleration give: u_side^2 / from_axis. */
DEM_INLINE double dem__bend(const dem_wall *wall, dem_vec u, double from_axis) {
    const double along = dem__dot(u, wall->axis[2]);
    return from_axis > 0.0 ? (dem__dot(u, u) - along * along) / from_axis : HUGE_VAL;
}

/* Returns a lower limit of the gap of bars that are not among those found [m]. */
static inline double dem__other_bars(const dem_world *w, const dem_wall *wall, double radius, const dem__touch *touch, int found) {
    double lowest = 0.0;
    for (int q = 0; q < found; q++) lowest = touch[q].gap < lowest ? touch[q].gap : lowest;
    const double third = dem__third_bar(wall, radius, lowest);
    return third < w->engine->pairs.wall_reach ? third : w->engine->pairs.wall_reach;
}

/* Returns a time [s] before which particle i cannot touch a wall, from its velocity and the tolerance of its bound; 0 if none is known.
   Near a wall it is longer than the time from speeds alone, but it holds for this bound only. A plane, a bar and a cylinder from outside
   are convex, so that a gap cannot shrink faster than along its normal. */
static inline double dem__time_to_wall(const dem_world *w, ptrdiff_t i, const dem_wall *wall, dem_vec v, int k, const dem__touch *touch,
                                       int found, double others) {
    const double stray = 2.0 * w->engine->bodies.bound[i].tolerance, near = w->engine->links.near + w->engine->pairs.position_tolerance,
                 radius = w->particle[i].radius;
    const dem_vec u = dem__sub(v, wall->velocity), g = dem__free_fall(w);
    double a = w->engine->pairs.gravity_size + wall->acceleration_bound, least = HUGE_VAL;
    if (found == 0 || wall->asked.drive != DEM_KINEMATIC || wall->kind > DEM_EXIT || wall->spin != 0.0 || !(a < HUGE_VAL)) return 0.0;
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

/* Returns how far x is from a face of the periodic box beyond which the wall does not continue [m]: walls are not repeated. */
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

/* Tests the particle and the wall of timer e, at a step to which the wall has been moved: begins contacts, or sets the timer. */
static inline void dem__test_wall(dem_world *w, int32_t e, int64_t step) {
    const dem__run *run = &w->engine->run;
    dem__bodies *bodies = &w->engine->bodies;
    const dem__pairs *pairs = &w->engine->pairs;
    const dem__links *links = &w->engine->links;
    const ptrdiff_t i = e / w->walls;
    const int k = (int)(e % w->walls);
    int found, touches = 0;
    dem_wall *wall = &w->wall[k];
    w->looks++;
    if (!w->alive[i] || !dem__is_at_wall(w, i, k)) return;
    double tau = (double)(step - w->particle[i].origin) * run->dt, least, others = pairs->wall_reach;
    dem_vec x = dem__at(w, i, tau), v = dem__velocity_at(w, i, tau);
    if (run->has_periodic) x = dem__in_box(w, x); /* where the step will put it: bars are told apart by their place */
    dem__touch touch[DEM__TOUCHES];
    found = dem__touch_wall(wall, x, w->particle[i].radius, w->def.skip & DEM_SKIP_SPACE ? pairs->wall_reach : links->near, touch, &least);
    if (wall->kind == DEM_EXIT) {
        const dem__rigid *r = dem__rigid_of(w, i);
        if (least < 0.0) {
            if (!r || dem__has_passed(wall, dem__in_box(w, dem__posture_at(w, r, tau).x))) dem__pass_exit(w, i, k);
            else if (w->def.skip & DEM_SKIP_SPACE) dem__set_timer(&w->engine->walls.timers, e, step + 1);
            return;
        }
    } else if (found > 0) {
        if (wall->kind == DEM_SCREEN) others = dem__other_bars(w, wall, w->particle[i].radius, touch, found);
        least = others;
        for (int q = 0; q < found; q++) {
            if (dem__touches_element(w, i, k, touch[q].element)) continue;
            const int linked = touch[q].gap < links->near && dem__link_of(w, i, -1 - k, touch[q].element) >= 0;
            if (touch[q].gap < (linked ? links->near : 0.0)) {
                if (!dem__new_wall_contact(w, i, k, &touch[q], touch[q].element)) return;
                touches = 1;
            } else least = touch[q].gap - links->near < least ? touch[q].gap - links->near : least;
        }
        if (touches && wall->kind != DEM_SCREEN) return;
    }
    if (!(w->def.skip & DEM_SKIP_SPACE)) return;
    const double crossing = run->has_periodic ? dem__far_from_faces(w, wall, x) : HUGE_VAL;
    least = crossing < least ? crossing : least;
    double speed = dem__length(v) + 2.0 * bodies->bound[i].tolerance;
    if (speed < 0.5 * bodies->wall_speed[i]) bodies->wall_speed[i] = 1.25 * speed;
    speed = (speed > bodies->wall_speed[i] ? speed : bodies->wall_speed[i]) + wall->speed_bound;
    int most = DEM__STEPS_MAX;
    if (wall->spin_bound > 0.0) { /* the surface is faster further out, where the particle may be at the next test */
        const double turn = DEM__RETEST_STEPS * run->dt, out = turn * (speed + turn * pairs->gravity_size);
        speed += wall->spin_bound * (dem__arm(wall, x) + out);
        most = DEM__RETEST_STEPS;
    }
    const int sure = dem__steps_until(w, dem__time_to_cover(least - pairs->position_tolerance, speed, pairs->gravity_size)),
              steps = sure < most ? sure : most;
    int better = 0;
    if (steps < DEM__RETEST_STEPS / 4 && crossing == HUGE_VAL)
        better = dem__steps_until(w, dem__time_to_wall(w, i, wall, v, k, touch, found, others));
    w->engine->walls.sure[e] = (uint32_t)(uint64_t)(step + steps);
    dem__set_timer(&w->engine->walls.timers, e, step + (better > steps ? better : steps));
}
