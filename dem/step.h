/* Of active particles first .. end-1, where memory is not asked ahead any more: the first, unless they are few and so lie far apart. */
DEM_INLINE ptrdiff_t dem__prefetch_until(const dem_world *w, ptrdiff_t first, ptrdiff_t end) {
    return 4 * w->engine->bodies.active_count < w->count ? end - DEM__AHEAD : first;
}

/* Active particles first .. end-1 to the time of the step that is being computed; their velocities to the middle of it. */
DEM_INLINE void dem__advance_all(dem_world *w, double h, ptrdiff_t first, ptrdiff_t end) {
    const int64_t step = w->step + (h > 0.0);
    const ptrdiff_t apart = dem__prefetch_until(w, first, end);
    const double dt = w->engine->run.dt;
    for (ptrdiff_t k = first; k < end; k++) {
        const ptrdiff_t i = w->engine->bodies.active[k];
        if (k < apart) dem__prefetch_particle(w, w->engine->bodies.active[k + DEM__AHEAD]);
        dem_particle *p = &w->particle[i];
        const double t = (double)(step - p->origin) * dt, middle = t - 0.5 * h;
        p->x = dem__at(w, i, t), p->v = dem__velocity_at(w, i, middle), p->spin = dem__spin_at(w, i, middle);
        if (w->engine->run.has_periodic) dem__wrap(w, i);
    }
}
DEM__AVX2_CLONE(dem__advance_part, (dem_world * w, double h, ptrdiff_t first, ptrdiff_t end), (w, h, first, end),
                dem__advance_all(w, h, first, end))
static inline void dem__advance_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *h) {
    (void)part;
    dem__advance_part(w, *(const double *)h, first, end);
}
static inline void dem__advance(dem_world *w, double h) {
    const ptrdiff_t n = w->engine->bodies.active_count;
    const int books = w->engine->ledger.on && w->engine->run.has_periodic;         /* those who leave the box are one sum */
    dem__in_parts(w, books ? 1 : dem__parts(w, n / 4), n, dem__advance_range, &h); /* to move or kick a particle is little work */
}

static inline void dem__gather_losses(dem_world *w) {
    const dem__bodies *bodies = &w->engine->bodies;
    const dem__contacts *contacts = &w->engine->contacts;
    dem_energy_ledger *l = &w->engine->ledger.sums;
    DEM__EACH_CONTACT(w, k) {
        l->normal_loss += contacts->loss[0][k];
        l->sliding_loss += contacts->loss[1][k];
        l->rolling_loss += contacts->loss[2][k];
        l->wall_work += contacts->loss[3][k];
    }
    for (ptrdiff_t k = 0; bodies->loads_on && k < bodies->active_count; k++) {
        const ptrdiff_t i = bodies->active[k];
        l->external_work += w->engine->run.dt * dem__dot(dem__first(bodies->external[i]), w->particle[i].v);
        l->external_work += w->engine->run.dt * dem__dot(dem__second(bodies->external[i]), w->particle[i].spin);
    }
}

/* Of a particle settled at time t on the bounds: how far its velocity is from that of its bound. */
DEM_INLINE dem_vec dem__deviation(const dem_world *w, ptrdiff_t i, double t) {
    const dem__bound *c = &w->engine->bodies.bound[i];
    return dem__sub(dem__plus(w->particle[i].v, -t, w->def.gravity), dem_vec3(c->ux, c->uy, c->uz));
}

/* The same at the end of the next step: between, it is on the line from one to the other. */
DEM_INLINE dem_vec dem__next_deviation(const dem_world *w, ptrdiff_t i, dem_vec d) {
    return dem__plus(d, w->engine->run.dt, dem__sub(w->particle[i].a, w->def.gravity));
}

/* Is the velocity of a particle, d from that of its bound, within its tolerance to the end of the next step? */
DEM_INLINE int dem__within_bound(const dem_world *w, ptrdiff_t i, dem_vec d) {
    const dem__bodies *bodies = &w->engine->bodies;
    const dem_vec e = dem__next_deviation(w, i, d);
    const double tolerance = bodies->bound[i].tolerance * bodies->bound[i].tolerance;
    return dem__dot(d, d) < tolerance && dem__dot(e, e) < tolerance &&
           bodies->shifted[i] < w->engine->pairs.position_tolerance; /* false for NaN */
}

/* Is the velocity sure to stay within its tolerance, to the end of the next step? */
DEM_INLINE int dem__surely_within(dem_particle *p, double dt, dem_vec pull) {
    const double way = dem__most_change(dt, pull);
    p->tolerance_left__ -= way;
    return p->tolerance_left__ > 0.5 * way; /* false for NaN */
}

/* New accelerations of active particles first .. end-1, and their velocities from the middle of the step to its end. Sums are zero
   afterwards, ready for the next. Those that may leave their tolerances are listed in remap__ from `first` on. */
DEM_INLINE void dem__kick_all(dem_world *w, double h, ptrdiff_t first, ptrdiff_t end, double *check, ptrdiff_t *strays) {
    dem__bodies *bodies = &w->engine->bodies;
    const int64_t step = w->step + (h > 0.0);
    const double half = 0.5 * h;
    const int loads = bodies->loads_on || w->engine->links.on;
    const double dt = w->engine->run.dt;
    const dem_vec gravity = w->def.gravity;
    int32_t *doubtful = w->engine->scratch.index + first;
    const ptrdiff_t apart = dem__prefetch_until(w, first, end);
    double all = 0.0;
    ptrdiff_t n = 0;
    for (ptrdiff_t k = first; k < end; k++) {
        const ptrdiff_t i = bodies->active[k];
        if (k < apart) dem__prefetch_body(w->particle, bodies->sum, bodies->active[k + DEM__AHEAD]);
        dem__sum *sum = &bodies->sum[i];
        dem_particle *p = &w->particle[i];
        dem_vec force = dem__first(sum->load), torque = dem__second(sum->load);
        if (loads) {
            force = dem__add(force, dem__first(bodies->load[i]));
            torque = dem__add(torque, dem__second(bodies->load[i]));
        }
        const dem_vec pull = dem__scale(sum->per_mass, force);
        p->a = dem__add(gravity, pull);
        const dem_vec turn = dem__scale(sum->per_inertia, torque);
        w->spin_rate[i] = turn;
        p->v = dem__plus(p->v, half, p->a);
        p->spin = dem__plus(p->spin, half, turn);
        p->origin = step;
        for (int a = 0; a < 6; a++) sum->load[a] = 0.0;
        all += pull.x + pull.y + pull.z + turn.x + turn.y + turn.z;
        doubtful[n] = (int32_t)i; /* without a branch, which no processor could predict */
        n += !dem__surely_within(p, dt, pull);
    }
    *check = 0.0 * all;
    *strays = n;
}
DEM__AVX2_CLONE(dem__kick_part, (dem_world * w, double h, ptrdiff_t first, ptrdiff_t end, double *check, ptrdiff_t *strays),
                (w, h, first, end, check, strays), dem__kick_all(w, h, first, end, check, strays))

/* Of n particles those that leave their tolerances; how many. The others get room anew. */
static inline ptrdiff_t dem__find_deviating(dem_world *w, double h, int32_t *doubtful, ptrdiff_t n) {
    const double t = dem__since_listed(w, w->step + (h > 0.0));
    ptrdiff_t strays = 0;
    for (ptrdiff_t k = -DEM__AHEAD; k < n; k++) {
        if (k + DEM__AHEAD < n) dem__prefetch_flight(w, doubtful[k + DEM__AHEAD]);
        if (k < 0) continue;
        const int32_t i = doubtful[k];
        const dem_vec stray = dem__deviation(w, i, t);
        if (dem__within_bound(w, i, stray)) dem__set_tolerance_left(w, i, dem__length(stray));
        else doubtful[strays++] = i;
    }
    return strays;
}
typedef struct dem__kicked {
    double h, check[DEM__PARTS_MAX]; /* check: 0, or NaN if a force is not finite */
    ptrdiff_t strays[DEM__PARTS_MAX];
} dem__kicked;
static inline void dem__kick_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    dem__kicked *kicked = (dem__kicked *)context;
    dem__kick_part(w, kicked->h, first, end, &kicked->check[part], &kicked->strays[part]);
    kicked->strays[part] = dem__find_deviating(w, kicked->h, w->engine->scratch.index + first, kicked->strays[part]);
}
static inline int dem__kick(dem_world *w, double h) {
    const ptrdiff_t n = w->engine->bodies.active_count;
    const int parts = dem__parts(w, n / 4); /* to move or kick a particle is little work */
    dem__kicked kicked;
    double all = 0.0;
    kicked.h = h;
    dem__in_parts(w, parts, n, dem__kick_range, &kicked);
    for (int q = 0; q < parts; q++) {
        const int32_t *stray = w->engine->scratch.index + dem__part(n, q, parts);
        for (ptrdiff_t k = 0; k < kicked.strays[q]; k++) dem__mark_to_check(w, stray[k]);
        all += kicked.check[q];
    }
    return all == 0.0;
}

/* A contact that has just begun has_friction the normal velocities of its bodies to and fro about that of their centre of mass: what leads there,
   for their bounds. */
DEM_INLINE void dem__expect_impact(dem_world *w, ptrdiff_t i, ptrdiff_t j, dem_vec n, double closing) {
    if (!(closing > 0.0)) return; /* it has ended */
    const double part = j < 0 ? 1.0 : w->particle[j].mass / (w->particle[i].mass + w->particle[j].mass);
    w->engine->bodies.impact[i] = dem__scale(part * closing, n);
    if (j >= 0) w->engine->bodies.impact[j] = dem__scale((part - 1.0) * closing, n);
}

/* Impulse and shift of the contact in slot c, which began or ended within the step. */
static inline void dem__apply_correction(dem_world *w, int32_t c, int has_friction) {
    dem__contacts *contacts = &w->engine->contacts;
    const dem__correction *h = &contacts->correction[c];
    const int32_t i = contacts->i[c], j = contacts->j[c];
    const dem_vec n = dem_vec3(h->n[0], h->n[1], h->n[2]), impulse = dem__first(h->impulse);
    for (int side = 0; side < (j >= 0 ? 2 : 1); side++) {
        const int32_t a = side ? j : i;
        dem__mark_to_check(w, a);
        dem_particle *p = &w->particle[a];
        const double m = (side ? -1.0 : 1.0) / p->mass;
        p->v = dem__plus(p->v, m, impulse);
        p->x = dem__plus(p->x, m * h->shift, n);
        w->engine->bodies.shifted[a] += fabs(m * h->shift);
        if (!has_friction) continue;
        const dem_vec torque = dem__first(h->impulse + (side ? 6 : 3));
        p->spin = dem__plus(p->spin, 1.0 / dem__inertia(w, a), torque);
    }
    if (j < 0) {
        const dem_vec place = w->particle[i].x, t = has_friction ? dem__second(h->impulse) : dem_vec3(0.0, 0.0, 0.0);
        const dem_vec v = dem__sub(w->particle[i].v, dem__surface_velocity(&w->wall[-1 - j], place, n));
        dem__strike_wall(&w->wall[-1 - j], place, dem__scale(-1.0, impulse), dem__scale(-1.0, t));
        dem__expect_impact(w, i, j, n, -dem__dot(v, n));
        return;
    }
    /* a pair that is moved apart has_friction more slowly, as its angular momentum stays */
    dem_particle *a = &w->particle[i], *b = &w->particle[j];
    const dem_vec d = dem__nearest_image(w, dem__sub(a->x, b->x)), v = dem__sub(a->v, b->v);
    const dem_vec slower = dem__scale(-h->shift / dem__length(d), dem__sub(v, dem__scale(dem__dot(v, n), n)));
    a->v = dem__plus(a->v, 1.0 / a->mass, slower);
    b->v = dem__plus(b->v, -1.0 / b->mass, slower);
    dem__expect_impact(w, i, j, n, -dem__dot(v, n));
}
static inline void dem__apply_corrections(dem_world *w, int has_friction) {
    const dem__contacts *contacts = &w->engine->contacts;
    for (const dem__chunk *in = contacts->chunk; in < contacts->chunk + contacts->chunk_count; in++) {
        for (ptrdiff_t k = 0; k < in->marked; k++) {
            const int32_t c = contacts->slots[in->first + k];
            if (contacts->edge[c]) dem__apply_correction(w, c, has_friction);
        }
    }
}

/* What became of a thread's share of the to_check: how many have new bounds, how many of those are to look at a wall sooner, and does
   any begin a flight. */
typedef struct dem__checked {
    ptrdiff_t reset, hurried;
    int flown;
    dem__outcome news;
} dem__checked;

/* Ahead of a watch. */
DEM_INLINE void dem__prefetch_check(const dem_world *w, ptrdiff_t i) {
    const dem__bodies *bodies = &w->engine->bodies;
    dem__prefetch_flight(w, i);
    DEM__PREFETCH(&w->engine->pairs.listed_at[i]);
    DEM__PREFETCH(&w->alive[i]);
    DEM__PREFETCH(&w->touching[i]);
    DEM__PREFETCH(&bodies->shifted[i]);
    DEM__PREFETCH(&bodies->wall_speed[i]);
    DEM__PREFETCH(&w->engine->walls.timers.due[i * w->walls]);
    DEM__PREFETCH(&w->engine->walls.sure[i * w->walls]);
}

/* Unsettled particles first .. end-1: whose velocity left its tolerance, or whose flight begins, gets a new bound and is listed in remap__ from
   `first` on; unsettled__ lists from there those that are to look at a wall sooner. */
static inline void dem__check_bounds_part(dem_world *w, ptrdiff_t first, ptrdiff_t end, dem__checked *q) {
    dem__bodies *bodies = &w->engine->bodies;
    const dem__list_frame frame = dem__frame_at(w, w->step);
    const double t = dem__since_listed(w, w->step);
    q->reset = q->hurried = q->flown = 0;
    q->news = dem__no_outcome(w);
    for (ptrdiff_t k = first - DEM__AHEAD; k < end; k++) {
        if (k + DEM__AHEAD < end) dem__prefetch_check(w, bodies->to_check[k + DEM__AHEAD]);
        if (k < first) continue;
        const int32_t i = bodies->to_check[k];
        if (w->alive[i] && !w->engine->run.needs_lists) {
            const dem_particle *p = &w->particle[i];
            const dem_vec stray = dem__deviation(w, i, t);
            if (w->touching[i] == 0 || !dem__within_bound(w, i, stray)) {
                const double shifted = bodies->shifted[i];
                dem__set_bound(w, i, w->step, p->x, p->v);
                w->engine->scratch.index[first + q->reset++] = i;
                if (dem__apply_bound(w, i, w->step, &frame, p->x, p->v, shifted, &q->news)) bodies->to_check[first + q->hurried++] = i;
            } else dem__set_tolerance_left(w, i, dem__length(stray));
        }
        bodies->impact[i] = dem_vec3(0.0, 0.0, 0.0);
        bodies->activity[i] = w->alive[i] && (w->touching[i] > 0 || (bodies->loads_on && dem__is_loaded(w, i)));
        q->flown |= !bodies->activity[i];
    }
}

static inline void dem__check_bounds_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *checked) {
    dem__check_bounds_part(w, first, end, (dem__checked *)checked + part);
}

/* Checks the bounds of particles marked for it, and sets new bounds and timers; whoever begins a flight leaves the list of active particles. */
static inline void dem__check_bounds(dem_world *w) {
    dem__bodies *bodies = &w->engine->bodies;
    const ptrdiff_t n = bodies->to_check_count, active = bodies->active_count;
    const int parts = dem__parts(w, 4 * n);
    dem__checked watched[DEM__PARTS_MAX];
    ptrdiff_t reset = 0, kept = 0;
    int flown = 0;
    dem__in_parts(w, parts, n, dem__check_bounds_range, watched);
    for (int q = 0; q < parts; q++) {
        const ptrdiff_t first = dem__part(n, q, parts);
        for (ptrdiff_t k = 0; k < watched[q].hurried; k++) dem__advance_wall_timers(w, bodies->to_check[first + k], w->step);
        for (ptrdiff_t k = 0; k < watched[q].reset; k++) w->engine->scratch.index[reset++] = w->engine->scratch.index[first + k];
        dem__apply_outcome(w, &watched[q].news);
        flown |= watched[q].flown;
    }
    dem__reset_pair_timers(w, w->engine->scratch.index, reset, w->step);
    bodies->to_check_count = 0;
    if (!flown) return;
    for (ptrdiff_t k = 0; k < active; k++) {
        const int32_t i = bodies->active[k];
        bodies->active[kept] = i;
        kept += bodies->activity[i] != 0;
    }
    bodies->active_count = kept;
    if (2 * kept > w->count && w->step % 16 == 0) dem__list_active(w);
}

static inline int dem__fail(dem_world *w, dem_status status) {
    w->status = status;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_particle *p = &w->particle[i];
        const dem_vec sum = dem__add(dem__add(p->v, p->a), dem__add(p->spin, w->spin_rate[i]));
        const double v = sum.x + sum.y + sum.z;
        if (!(fabs(v) <= DBL_MAX)) {
            w->failed_id = w->id[i];
            break;
        }
    }
    return 0;
}

/* Looks at the pairs that are due, in pages first .. end-1. */
static inline void dem__test_due_part(dem_world *w, dem__timer_batch *waits, ptrdiff_t first, ptrdiff_t end, int64_t step) {
    dem__pairs *pairs = &w->engine->pairs;
    int32_t *due = pairs->timers.list + first * DEM__PAGE;
    ptrdiff_t n;
    dem__list_due(&pairs->timers, first, end, step, DEM__NEVER, &n);
    dem__clear_batch(waits);
    waits->found = due; /* what is found overwrites what has been looked at */
    for (ptrdiff_t k = -2 * DEM__AHEAD; k < n; k++) {
        const ptrdiff_t flight = k + DEM__AHEAD, pair = flight + DEM__AHEAD;
        if (pair < n) DEM__PREFETCH(&pairs->near[due[pair]]);
        if (flight >= 0 && flight < n) {
            dem__prefetch_flight(w, pairs->near[due[flight]].i);
            dem__prefetch_flight(w, pairs->near[due[flight]].j);
        }
        if (k >= 0) dem__test_pair(w, waits, due[k], step);
    }
    dem__flush_batch(w, waits, step);
}

static inline void dem__test_due_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *step) {
    dem__test_due_part(w, &w->engine->scratch.work[part].batch, first, end, *(const int64_t *)step);
}

/* Tests the pairs that are due. Threads take pages of their own, if about as many pairs are due as in the step before. */
static inline void dem__test_due_pairs(dem_world *w, int64_t step) {
    dem__pairs *pairs = &w->engine->pairs;
    const int parts = dem__parts_of(w, pairs->due_count, w->engine->scratch.works);
    dem__work *work = w->engine->scratch.work;
    dem__in_parts(w, parts, pairs->timers.pages, dem__test_due_range, &step);
    pairs->due_count = 0;
    for (int q = 0; q < parts; q++) {
        pairs->due_count += (ptrdiff_t)work[q].batch.looks;
        dem__new_pair_contacts(w, &work[q].batch);
    }
}

/* Looks at all pairs that do not touch. */
static inline void dem__test_all_pairs(dem_world *w, int64_t step) {
    const dem__pairs *pairs = &w->engine->pairs;
    dem__timer_batch waits;
    dem__clear_batch(&waits);
    waits.found = pairs->timers.list;
    for (int32_t p = 0; p < (int32_t)pairs->count; p++) {
        if (pairs->timers.due[p] != DEM__STOPPED) dem__test_pair(w, &waits, p, step);
    }
    dem__new_pair_contacts(w, &waits);
}

/* Looks at everything whose time has come, at the given step. */
static inline void dem__detect(dem_world *w, int64_t step) {
    dem__wall_state *walls = &w->engine->walls;
    if (walls->meshes) dem__follow_meshes(w, step);
    if (!(w->def.skip & DEM_SKIP_PAIRS)) dem__test_all_pairs(w, step);
    if (!(w->def.skip & DEM_SKIP_SPACE)) {
        for (int32_t e = 0; e < (int32_t)(w->count * w->walls); e++) {
            if (dem__needs_test(w, e / w->walls, (int)(e % w->walls))) dem__test_wall(w, e, step);
        }
    }
    dem__test_due_pairs(w, step);
    ptrdiff_t n;
    dem__list_due(&walls->timers, 0, walls->timers.pages, step, DEM__STOPPED, &n);
    for (ptrdiff_t k = 0; k < n; k++) dem__test_wall(w, walls->timers.list[k], step);
}

/* Takes back what was found in a step that cannot be finished. */
static DEM__NOINLINE int dem__undo_detection(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    for (; contacts->begun > 0; contacts->begun--) {
        const int32_t p = contacts->near[dem__next_slot(w) - 1];
        contacts->chunk[contacts->chunk_count - 1].count--;
        contacts->count--;
        if (p >= 0) w->engine->pairs.timers.due[p] = DEM__NEVER;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i] < 0) w->alive[i] = 1, w->passed_count--;
    }
    w->engine->run.leaving = 0;
    for (int k = 0; k < w->walls; k++) dem__move_wall(&w->wall[k], w->time);
    return 0;
}

/* Runs the links' kernel on blocks first .. end - 1. */
static inline void dem__evaluate_links_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__links *links = &w->engine->links;
    (void)context;
    links->kernel(w, DEM__BLOCK * first, DEM__BLOCK * end < links->count ? DEM__BLOCK * end : links->count, part);
}
static inline void dem__evaluate_links(dem_world *w) {
    const ptrdiff_t n = w->engine->links.count;
    dem__in_parts(w, dem__link_parts(w), (n + DEM__BLOCK - 1) / DEM__BLOCK, dem__evaluate_links_range, NULL);
}

/* An evaluation of all contacts by several threads. */
typedef struct dem__evaluation {
    dem_kernel_fn kernel;
    int parts, has_friction;
} dem__evaluation;

/* Adds what the threads that evaluated the contacts could not to the sums of particles low .. high-1. */
static inline void dem__add_postponed_to(dem_world *w, int32_t low, int32_t high, int has_friction) {
    const dem__contacts *contacts = &w->engine->contacts;
    for (const dem__chunk *in = contacts->chunk; in < contacts->chunk + contacts->chunk_count; in++) {
        dem__postponed *later = contacts->postponed + in->first;
        if (in->postponed == 0 || in->low >= high || in->high < low) continue;
        for (ptrdiff_t k = 0; k < in->postponed; k++, later++) {
            const int32_t from = low > in->postpone_from ? low : in->postpone_from; /* the rest has been added */
            const int to_i = later->i >= from && later->i < high, to_j = later->j >= from && later->j < high;
            double *out[9];
            for (int a = 0; a < 9; a++) out[a] = &later->out[a];
            dem__add_forces(w, 0, later->i, later->j, out, 0, has_friction, to_i, to_j);
        }
    }
}

/* Each thread adds the postponed forces on the particles of the share before its own (the first thread: of the last share): it made nearly
   all of them itself, so they are in its cache. */
static inline void dem__add_postponed_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__evaluation *e = (const dem__evaluation *)context;
    const dem__chunk *chunk = w->engine->contacts.chunk;
    const int chunks = w->engine->contacts.chunk_count, share = (part + e->parts - 1) % e->parts;
    first = dem__part(chunks, share, e->parts), end = dem__part(chunks, share + 1, e->parts);
    dem__add_postponed_to(w, chunk[end - 1].first_particle, first > 0 ? chunk[first - 1].first_particle : INT32_MAX, e->has_friction);
}
static inline void dem__add_postponed(dem_world *w, int has_friction) {
    const dem__contacts *contacts = &w->engine->contacts;
    dem__evaluation e;
    ptrdiff_t n = 0;
    for (int q = 0; q < contacts->chunk_count; q++) n += contacts->chunk[q].postponed;
    e.parts = dem__parts_of(w, n, contacts->chunk_count), e.has_friction = has_friction;
    if (e.parts == 1) dem__add_postponed_to(w, 0, INT32_MAX, has_friction);
    else dem__in_parts(w, e.parts, contacts->chunk_count, dem__add_postponed_range, &e);
}

/* Evaluates the chunks of a share. Its thread may add to the particles whose contacts are all in this share or in later ones; the share
   before has the others. */
static inline void dem__evaluate_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__evaluation *e = (const dem__evaluation *)context;
    dem__chunk *chunk = w->engine->contacts.chunk;
    for (ptrdiff_t q = first; q < end; q++) chunk[q].postpone_from = first > 0 ? chunk[first - 1].first_particle : INT32_MAX;
    e->kernel(w, first, end, part);
}

/* Forces of all contacts and their sums; what each contact did is kept if somebody may ask for it. */
static inline void dem__evaluate(dem_world *w, dem_kernel_fn kernel, double h, int has_friction, int keep) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__evaluation e;
    e.kernel = kernel, e.has_friction = has_friction;
    e.parts = contacts->postponed
                  ? dem__parts_of(w, contacts->count,
                                  contacts->chunk_count < w->engine->scratch.works ? contacts->chunk_count : w->engine->scratch.works)
                  : 1;
    w->engine->run.kernel_dt = h;
    w->engine->run.keeps_wrenches = keep;
    dem__in_parts(w, e.parts, contacts->chunk_count, dem__evaluate_range, &e);
    if (e.parts > 1) dem__add_postponed(w, has_friction);
    for (int k = 0; k < w->walls; k++) {
        dem_wall *wall = &w->wall[k];
        wall->force = wall->torque = dem_vec3(0.0, 0.0, 0.0);
        for (int q = 0; q < contacts->chunk_count; q++) {
            const dem__wall_force *push = &contacts->wall_force[q * w->engine->walls.capacity + k];
            wall->force = dem__add(wall->force, push->force);
            wall->torque = dem__add(wall->torque, push->torque);
        }
        wall->impulse = dem__plus(wall->impulse, h, wall->force);
    }
}

/* All contacts into the order of their particles i, the last first, else as they were: neighbours in space are then read one after the
   other. Many in chunks of equal size, with room to grow. */
static inline int dem__reorder_contacts(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    const ptrdiff_t n = contacts->count;
    const int chunks = n < DEM__CHUNKS * 512 ? 1 : DEM__CHUNKS;
    dem__chunk chunk[DEM__CHUNKS];
    dem__array list[DEM__ARRAYS_MAX];
    int32_t *place = w->engine->scratch.index, sum = 0, before = INT32_MAX;
    ptrdiff_t end = 0, cut = 0;
    int in_order = chunks == contacts->chunk_count;
    DEM__EACH_CONTACT(w, c) {
        in_order &= before >= contacts->i[c];
        before = contacts->i[c];
    }
    if (!in_order) {
        for (ptrdiff_t i = 0; i < w->count; i++) place[i] = 0;
        DEM__EACH_CONTACT(w, c) { place[contacts->i[c]]++; }
        for (ptrdiff_t i = w->count - 1; i >= 0; i--) {
            const int32_t of = place[i];
            place[i] = sum;
            sum += of;
        }
        DEM__EACH_CONTACT(w, c) { contacts->slots[place[contacts->i[c]]++] = (int32_t)c; }
        memset(chunk, 0, sizeof chunk);
        for (int q = 0; q < chunks; q++) {
            const ptrdiff_t first = cut;
            if (dem__part(n, q + 1, chunks) > cut) cut = dem__part(n, q + 1, chunks);
            while (cut < n && contacts->i[contacts->slots[cut]] == contacts->i[contacts->slots[cut - 1]]) cut++;
            chunk[q].first_particle = q < chunks - 1 ? contacts->i[contacts->slots[cut - 1]] : 0;
            chunk[q].first = end;
            chunk[q].count = cut - first;
            chunk[q].capacity = chunks > 1 ? chunk[q].count + chunk[q].count / 4 + DEM__BLOCK : 0;
            end += chunk[q].capacity;
        }
        if (!dem__grow_contacts(w, end + 1)) {
            w->status = DEM_OUT_OF_MEMORY;
            return 0;
        }
        dem__arrange(w, n, chunk, chunks, list, dem__kept_arrays(w, list));
        contacts->chunk_count = chunks;
        memcpy(contacts->chunk, chunk, sizeof chunk);
        dem__list_wall_contacts(w);
    }
    return 1;
}

/* Begins a run: lists, contacts that are already there, their forces and so the accelerations. */
static DEM__NOINLINE int dem__prepare_run(dem_world *w, const dem_law *law, dem_kernel_fn kernel, int features) {
    dem__run *run = &w->engine->run;
    dem__contacts *contacts = &w->engine->contacts;
    dem__ledger *ledger = &w->engine->ledger;
    ptrdiff_t born = 0;
    if (run->needs_lists) {
        DEM__EACH_CONTACT(w, c) { /* contacts with walls that were taken away */
            if (contacts->j[c] < 0 && !w->wall[-1 - contacts->j[c]].enabled) contacts->ended[c] = 1;
        }
        dem__remove_ended(w, w->step, 1);
        if (!dem__rebuild(w)) return 0;
    }
    for (int k = 0; k < w->walls; k++) dem__move_wall(&w->wall[k], w->time);
    for (int a = 0; a < w->def.materials; a++) {
        for (int b = 0; b < w->def.materials; b++) {
            const dem_pair_def *pair = dem_pair(&w->def, a, b);
            run->damping_ratio[a][b] = dem_damping_ratio(pair->restitution, pair->mode);
        }
    }
    if (run->needs_forces) {
        int skip = w->def.skip;
        w->def.skip = 0; /* everything, once; the timers stay */
        dem__test_all_pairs(w, w->step);
        for (ptrdiff_t i = 0; i < w->count; i++) {
            for (int k = 0; k < w->walls; k++) {
                if (w->wall[k].kind != DEM_EXIT && dem__needs_test(w, i, k)) dem__test_wall(w, (int32_t)i * w->walls + k, w->step);
            }
        }
        w->def.skip = skip;
        if (w->status != DEM_OK) return dem__undo_detection(w);
        born = contacts->begun;
        dem__commit_begun(w, 0.0);
        dem__list_active(w);
        for (ptrdiff_t k = 0; k < born; k++) {
            const int32_t c = contacts->slots[k], i = contacts->i[c], j = contacts->j[c];
            if (j < 0 && w->wall[-1 - j].kind != DEM_SCREEN) dem__stop_timer(&w->engine->walls.timers, i * w->walls - 1 - j);
        }
    }
    if (run->needs_forces || run->features != features || run->law != law) {
        contacts->type_count = 0;
        DEM__EACH_CONTACT(w, c) { dem__set_constants(w, c, law, features); }
    }
    run->features = features;
    run->law = law;
    if (run->needs_forces) {
        dem__report_begun(w, law, born);
        if (!dem__reorder_contacts(w)) return 0;
        dem__advance(w, 0.0);
        dem__evaluate(w, kernel, 0.0, (features & DEM_FRICTION) != 0, 1);
        if (!dem__kick(w, 0.0)) return dem__fail(w, DEM_NOT_FINITE);
        dem__kick_walls(w, 0.0);
        dem__remove_ended(w, w->step, 0);
        dem__check_bounds(w);
        if (w->status != DEM_OK) return 0;
    }
    run->needs_forces = 0;
    if ((features & DEM_ENERGY) && !ledger->started) {
        ledger->started = 1;
        dem_energy_ledger now = dem_energy(w);
        ledger->sums.start = now.kinetic + now.rotational + now.elastic + now.potential;
        ledger->sums.start_potential = now.potential;
    }
    return 1;
}

DEM_INLINE double dem__motion_energy(const dem_world *w, ptrdiff_t i) { return dem__kinetic(w, i) + dem__rotational(w, i); }

/* Links by velocity Verlet with a step of their own: their forces are constant between two evaluations, and at each the velocities
   get what the mean of the old force and the new one would have made. */
static inline void dem__step_links(dem_world *w) {
    dem__run *run = &w->engine->run;
    dem__bodies *bodies = &w->engine->bodies;
    dem__links *links = &w->engine->links;
    dem__ledger *ledger = &w->engine->ledger;
    const double h = (double)links->stride * run->dt;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (links->first_link[i] < 0 && !links->is_loaded[i]) continue;
        dem__set_origin(w, i);
        dem__wrap(w, i);
        if (ledger->on) ledger->sums.link_work += dem__link_work(w, i) - dem__motion_energy(w, i);
        for (int a = 0; a < 6; a++) bodies->sum[i].load[a] = bodies->load[i][a], bodies->load[i][a] = bodies->external[i][a];
    }
    run->kernel_dt = h;
    dem__evaluate_links(w);
    if (dem__link_parts(w) > 1) dem__add_links(w, 0, links->count);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (links->first_link[i] < 0 && !links->is_loaded[i]) continue;
        const dem__sum *sum = &bodies->sum[i];
        dem_particle *p = &w->particle[i];
        const dem_vec force = dem__sub(dem__first(bodies->load[i]), dem__first(sum->load));
        const dem_vec torque = dem__sub(dem__second(bodies->load[i]), dem__second(sum->load));
        const dem_vec a = dem__scale(sum->per_mass, force), b = dem__scale(sum->per_inertia, torque); /* changes */
        links->is_loaded[i] = links->first_link[i] >= 0;
        p->v = dem__plus(p->v, 0.5 * h, a), p->a = dem__add(p->a, a);
        p->spin = dem__plus(p->spin, 0.5 * h, b), w->spin_rate[i] = dem__add(w->spin_rate[i], b);
        if (ledger->on) {
            ledger->sums.link_work += dem__motion_energy(w, i);
            for (int q = 0; q < 3; q++) links->evaluated_at[i][q] = dem_axis(p->x, q), links->evaluated_at[i][3 + q] = dem_axis(p->spin, q);
        }
        for (int q = 0; q < 6; q++) bodies->sum[i].load[q] = 0.0;
        if (run->needs_lists) continue;
        const double strayed = dem__length(dem__deviation(w, i, dem__since_listed(w, w->step)));
        if (strayed < bodies->bound[i].tolerance - dem__link_drift(w, i)) dem__set_tolerance_left(w, i, strayed);
        else {
            const int32_t one = (int32_t)i;
            dem__renew_bound(w, i, w->step);
            dem__reset_pair_timers(w, &one, 1, w->step);
        }
    }
    for (int32_t k = 0; k < (int32_t)links->count;) {
        if (links->ended[k]) dem__cut_link(w, k);
        else k++;
    }
}

static inline int dem__step(dem_world *w, const dem_law *law, dem_kernel_fn kernel, int features, int keep) {
    dem__run *run = &w->engine->run;
    dem__contacts *contacts = &w->engine->contacts;
    const int has_friction = (features & DEM_FRICTION) != 0;
    if (w->step % DEM__REORDER_STEPS == 0 && !dem__reorder_contacts(w)) return 0;
    if (w->step >= w->engine->pairs.next_check && !dem__check_list(w)) return 0;
    if (!dem__move_walls(w, w->step + 1)) w->status = DEM_NOT_FINITE;
    else dem__detect(w, w->step + 1);
    if (w->status != DEM_OK) return dem__undo_detection(w);
    if (contacts->begun) {
        const ptrdiff_t born = contacts->begun;
        dem__commit_begun(w, 1.0);
        dem__advance(w, run->dt);
        for (ptrdiff_t k = 0; k < born; k++) dem__set_constants(w, contacts->slots[k], law, features);
        dem__report_begun(w, law, born);
    } else dem__advance(w, run->dt);
    dem__evaluate(w, kernel, run->dt, has_friction, keep);
    if (features & DEM_ENERGY) dem__gather_losses(w);
    const int finite = dem__kick(w, run->dt);
    dem__kick_walls(w, run->dt);
    dem__apply_corrections(w, has_friction);
    w->particle_steps += w->count - w->engine->bodies.dropped;
    w->contact_steps += contacts->count;
    w->step++;
    w->time = run->start_time + (double)(w->step - run->start_step) * run->dt;
    if (!finite) return dem__fail(w, DEM_NOT_FINITE);
    const int leaving = run->leaving;
    if (leaving) {
        DEM__EACH_CONTACT(w, c) {
            const ptrdiff_t j = contacts->j[c];
            if (w->alive[contacts->i[c]] < 0 || (j >= 0 && w->alive[j] < 0)) contacts->ended[c] = 1;
        }
        for (ptrdiff_t i = 0; i < w->count; i++) {
            if (w->alive[i] < 0) dem__detach_particle(w, i);
        }
        run->leaving = 0;
    }
    dem__remove_ended(w, w->step, leaving);
    if (leaving) dem__free_untouched(w);
    dem__check_bounds(w);
    if (w->engine->links.stride > 0 && w->step % w->engine->links.stride == 0) dem__step_links(w);
    return w->status == DEM_OK;
}

/* A kernel says so of no contacts if it is not for this law and these features. */
static inline int dem__fits(dem_world *w, const dem_law *law, dem_kernel_fn kernel, int features) {
    dem__run *run = &w->engine->run;
    const dem_law *old_law = run->law;
    const int old_features = run->features;
    run->law = law, run->features = features;
    kernel(w, 0, 0, 0);
    const int fits = w->status == DEM_OK;
    run->law = old_law, run->features = old_features;
    w->status = DEM_OK;
    return fits;
}

DEM_API dem_status dem_run_law(dem_world *world, double duration, const dem_law *law, dem_kernel_fn kernel, int features) {
    dem_world *w = world;
    if (!w || !w->def.allocator.fn || !law || !kernel || !law->force || !law->prepare || !(duration >= 0.0 && duration <= DBL_MAX))
        return DEM_BAD_ARGUMENT;
    if (law->states < 0 || law->states > DEM_STATE_MAX || law->vectors < 0 || 3 * law->vectors > law->history || law->history > law->states)
        return DEM_BAD_ARGUMENT;
    if (law->constants < 0 || law->constants > DEM_CONSTANTS_MAX) return DEM_BAD_ARGUMENT;
    double remaining = (w->engine->run.target + duration - w->time) / w->engine->run.dt;
    if (!(remaining < 9e15)) return DEM_BAD_ARGUMENT;
    if (w->status != DEM_OK) return w->status;
    if (!dem__make_work(w, w->def.threads)) return DEM_OUT_OF_MEMORY;
    if (!dem__fits(w, law, kernel, features)) return DEM_BAD_ARGUMENT;
    for (int k = 0; k < w->walls; k++) {
        if (w->wall[k].drive == DEM_PRESCRIBED && !w->wall[k].motion) return DEM_NO_MOTION;
    }
    const double narrowest = dem__narrowest(w);
    for (ptrdiff_t i = 0; i < w->count && narrowest < HUGE_VAL; i++) {
        if (w->alive[i] && !(narrowest > 4.4 * w->particle[i].radius)) return DEM_BAD_DEFINITION;
    }
    if (law->states != w->engine->contacts.states && w->engine->contacts.count > 0) return DEM_LAW_MISMATCH;
    if (w->engine->links.count > 0 && !w->engine->links.law) return DEM_LAW_MISMATCH; /* loaded: dem_set_links comes first */
    const int ledger = w->engine->ledger.on || (features & DEM_ENERGY),
              constants = law->constants > w->engine->contacts.constants ? law->constants : w->engine->contacts.constants;
    const int postpones = dem__may_postpone(w) && !w->engine->contacts.postponed;
    if (law->states != w->engine->contacts.states || constants != w->engine->contacts.constants || ledger != w->engine->ledger.on ||
        postpones) { /* other arrays: a new block */
        dem__array list[DEM__ARRAYS_MAX];
        const int old_states = w->engine->contacts.states, old_constants = w->engine->contacts.constants, old_ledger = w->engine->ledger.on;
        const ptrdiff_t old_capacity = w->engine->contacts.capacity;
        w->engine->contacts.states = law->states, w->engine->contacts.constants = constants, w->engine->ledger.on = ledger;
        if (!dem__grow_group(w, list, dem__contact_arrays(w, list), &w->engine->contacts.block, &w->engine->contacts.bytes,
                             &w->engine->contacts.capacity, dem__next_slot(w) + 1)) {
            w->engine->contacts.states = old_states, w->engine->contacts.constants = old_constants, w->engine->ledger.on = old_ledger;
            w->engine->contacts.capacity = old_capacity;
            return DEM_OUT_OF_MEMORY;
        }
        for (int a = w->engine->contacts.states; a < DEM_STATE_MAX; a++) w->engine->contacts.state[a] = NULL; /* not in the block */
    }
    if (!dem__prepare_run(w, law, kernel, features)) return w->status;
    w->engine->run.target += duration;
    for (int64_t n = remaining > 0.0 ? (int64_t)floor(remaining + 0.5) : 0; n > 0; n--) {
        if (!dem__step(w, law, kernel, features, n == 1)) return w->status;
    }
    return DEM_OK;
}

/* name, version, states, history, vectors, constants, prepare, force, born, ended */
static const dem_law dem_law_linear = {"linear", 1, 0, 0, 0, DEM_LINEAR_CONSTANTS, dem_prepare_linear, dem_force_linear, NULL, NULL};
static const dem_law dem_law_linear_friction = {"linear, friction",        1,    3,   3, 1, DEM_LINEAR_CONSTANTS, dem_prepare_linear,
                                                dem_force_linear_friction, NULL, NULL};
static const dem_law dem_law_linear_rolling = {"linear, friction, rolling", 1,    3,   3, 1, DEM_LINEAR_CONSTANTS, dem_prepare_linear,
                                               dem_force_linear_rolling,    NULL, NULL};
static const dem_law dem_law_hertz = {"Hertz", 1, 0, 0, 0, DEM_HERTZ_CONSTANTS, dem_prepare_hertz, dem_force_hertz, NULL, NULL};
static const dem_law dem_law_hertz_friction = {"Hertz-Mindlin",          1,    4,   4, 1, DEM_HERTZ_CONSTANTS, dem_prepare_hertz,
                                               dem_force_hertz_friction, NULL, NULL};
static const dem_law dem_law_hertz_rolling = {"Hertz-Mindlin, rolling", 1,    4,   4, 1, DEM_HERTZ_CONSTANTS, dem_prepare_hertz,
                                              dem_force_hertz_rolling,  NULL, NULL};

DEM_KERNEL(dem__kernel_linear, dem_law_linear, DEM_LINEAR)
DEM_KERNEL(dem__kernel_linear_friction, dem_law_linear_friction, DEM_LINEAR | DEM_FRICTION)
DEM_KERNEL(dem__kernel_linear_rolling, dem_law_linear_rolling, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING)
DEM_KERNEL(dem__kernel_linear_energy, dem_law_linear_rolling, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY)
DEM_KERNEL(dem__kernel_hertz, dem_law_hertz, DEM_HERTZ)
DEM_KERNEL(dem__kernel_hertz_friction, dem_law_hertz_friction, DEM_HERTZ | DEM_FRICTION)
DEM_KERNEL(dem__kernel_hertz_rolling, dem_law_hertz_rolling, DEM_HERTZ | DEM_FRICTION | DEM_ROLLING)
DEM_KERNEL(dem__kernel_hertz_energy, dem_law_hertz_rolling, DEM_HERTZ | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY)

DEM__CHOICE dem_status dem_run(dem_world *world, double duration, int features) {
    /* the kernels with a ledger compute friction and rolling always; constants of zero take out what the caller did not name */
    switch (features) {
    case DEM_LINEAR: return dem_run_law(world, duration, &dem_law_linear, dem__kernel_linear, features);
    case DEM_LINEAR | DEM_FRICTION: return dem_run_law(world, duration, &dem_law_linear_friction, dem__kernel_linear_friction, features);
    case DEM_LINEAR | DEM_FRICTION | DEM_ROLLING:
        return dem_run_law(world, duration, &dem_law_linear_rolling, dem__kernel_linear_rolling, features);
    case DEM_HERTZ: return dem_run_law(world, duration, &dem_law_hertz, dem__kernel_hertz, features);
    case DEM_HERTZ | DEM_FRICTION: return dem_run_law(world, duration, &dem_law_hertz_friction, dem__kernel_hertz_friction, features);
    case DEM_HERTZ | DEM_FRICTION | DEM_ROLLING:
        return dem_run_law(world, duration, &dem_law_hertz_rolling, dem__kernel_hertz_rolling, features);
    case DEM_LINEAR | DEM_ENERGY:
    case DEM_LINEAR | DEM_FRICTION | DEM_ENERGY:
    case DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY:
        return dem_run_law(world, duration, &dem_law_linear_rolling, dem__kernel_linear_energy, features);
    case DEM_HERTZ | DEM_ENERGY:
    case DEM_HERTZ | DEM_FRICTION | DEM_ENERGY:
    case DEM_HERTZ | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY:
        return dem_run_law(world, duration, &dem_law_hertz_rolling, dem__kernel_hertz_energy, features);
    default: return DEM_BAD_ARGUMENT;
    }
}
