/* Of active particles first .. end-1, where memory is not asked ahead any more: the first, unless they are few and so lie far apart. */
DEM_INLINE ptrdiff_t dem__fetch_until(const dem_world *w, ptrdiff_t first, ptrdiff_t end) {
    return 4 * w->active_count__ < w->count ? end - DEM__AHEAD : first;
}

/* Active particles first .. end-1 to the time of the step that is being computed; their velocities to the middle of it. */
DEM_INLINE void dem__advance_all(dem_world *w, double h, ptrdiff_t first, ptrdiff_t end) {
    const int64_t step = w->step + (h > 0.0);
    const ptrdiff_t apart = dem__fetch_until(w, first, end);
    for (ptrdiff_t k = first; k < end; k++) {
        const ptrdiff_t i = w->active__[k];
        if (k < apart) dem__fetch_particle(w, w->active__[k + DEM__AHEAD]);
        dem_particle *p = &w->particle[i];
        const double t = (double)(step - p->origin) * w->dt__, middle = t - 0.5 * h;
        p->x = dem__at(w, i, t), p->v = dem__velocity_at(w, i, middle), p->spin = dem__spin_at(w, i, middle);
        if (w->has_periodic__) dem__wrap(w, i);
    }
}
DEM__TWICE(dem__advance_part, (dem_world * w, double h, ptrdiff_t first, ptrdiff_t end), (w, h, first, end),
           dem__advance_all(w, h, first, end))
static inline void dem__advance(dem_world *w, double h) {
    const ptrdiff_t n = w->active_count__;
    const int books = w->ledger_on__ && w->has_periodic__; /* those who leave the box are one sum */
    const int parts = books ? 1 : dem__parts(w, n / 4);    /* to move or kick a particle is little work */
    int q;
    if (parts == 1) {
        dem__advance_part(w, h, 0, n);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
    for (q = 0; q < parts; q++) dem__advance_part(w, h, dem__part(n, q, parts), dem__part(n, q + 1, parts));
}

static inline void dem__gather_losses(dem_world *w) {
    dem_energy_ledger *l = &w->ledger__;
    DEM__EACH(w, k) {
        l->normal_loss += w->live_loss__[0][k];
        l->sliding_loss += w->live_loss__[1][k];
        l->rolling_loss += w->live_loss__[2][k];
        l->wall_work += w->live_loss__[3][k];
    }
    for (ptrdiff_t k = 0; w->loads_on__ && k < w->active_count__; k++) {
        const ptrdiff_t i = w->active__[k];
        l->external_work += w->dt__ * dem__dot(dem__first(w->external__[i]), w->particle[i].v);
        l->external_work += w->dt__ * dem__dot(dem__second(w->external__[i]), w->particle[i].spin);
    }
}

/* Of a particle settled at time t on the courses: how far its velocity is from that of its course. */
DEM_INLINE dem_vec dem__stray(const dem_world *w, ptrdiff_t i, double t) {
    const dem__course *c = &w->course__[i];
    return dem__sub(dem__plus(w->particle[i].v, -t, w->def.gravity), dem_vec3(c->ux, c->uy, c->uz));
}

/* The same at the end of the next step: between, it is on the line from one to the other. */
DEM_INLINE dem_vec dem__stray_next(const dem_world *w, ptrdiff_t i, dem_vec d) {
    return dem__plus(d, w->dt__, dem__sub(w->particle[i].a, w->def.gravity));
}

/* Is the velocity of a particle, d from that of its course, within its ball to the end of the next step? */
DEM_INLINE int dem__holds_course(const dem_world *w, ptrdiff_t i, dem_vec d) {
    const dem_vec e = dem__stray_next(w, i, d);
    const double ball = w->course__[i].ball * w->course__[i].ball;
    return dem__dot(d, d) < ball && dem__dot(e, e) < ball && w->shifted__[i] < w->blur__; /* false for NaN */
}

/* Is the velocity sure to stay within its ball, to the end of the next step? */
DEM_INLINE int dem__stays(dem_particle *p, double dt, dem_vec pull) {
    const double way = dem__way(dt, pull);
    p->room__ -= way;
    return p->room__ > 0.5 * way; /* false for NaN */
}

/* New accelerations of active particles first .. end-1, and their velocities from the middle of the step to its end. Sums are zero
   afterwards, ready for the next. Those that may leave their balls are listed in remap__ from `first` on. */
DEM_INLINE void dem__kick_all(dem_world *w, double h, ptrdiff_t first, ptrdiff_t end, double *check, ptrdiff_t *strays) {
    const int64_t step = w->step + (h > 0.0);
    const double half = 0.5 * h;
    const int loads = w->loads_on__ || w->links_on__;
    const ptrdiff_t apart = dem__fetch_until(w, first, end);
    double all = 0.0;
    ptrdiff_t n = 0;
    for (ptrdiff_t k = first; k < end; k++) {
        const ptrdiff_t i = w->active__[k];
        if (k < apart) dem__fetch_partner(w, w->active__[k + DEM__AHEAD]);
        dem__sum *sum = &w->sum__[i];
        dem_particle *p = &w->particle[i];
        dem_vec force = dem__first(sum->load), torque = dem__second(sum->load);
        if (loads) {
            force = dem__add(force, dem__first(w->load__[i]));
            torque = dem__add(torque, dem__second(w->load__[i]));
        }
        const dem_vec pull = dem__scale(sum->per_mass, force);
        p->a = dem__add(w->def.gravity, pull);
        const dem_vec turn = dem__scale(sum->per_inertia, torque);
        w->spin_rate[i] = turn;
        p->v = dem__plus(p->v, half, p->a);
        p->spin = dem__plus(p->spin, half, turn);
        p->origin = step;
        for (int a = 0; a < 6; a++) sum->load[a] = 0.0;
        all += pull.x + pull.y + pull.z + turn.x + turn.y + turn.z;
        w->remap__[first + n] = (int32_t)i; /* without a branch, which nobody could predict */
        n += !dem__stays(p, w->dt__, pull);
    }
    *check = 0.0 * all;
    *strays = n;
}
DEM__TWICE(dem__kick_part, (dem_world * w, double h, ptrdiff_t first, ptrdiff_t end, double *check, ptrdiff_t *strays),
           (w, h, first, end, check, strays), dem__kick_all(w, h, first, end, check, strays))

/* Of n particles those that leave their balls; how many. The others get room anew. */
static inline ptrdiff_t dem__find_strays(dem_world *w, double h, int32_t *doubtful, ptrdiff_t n) {
    const double t = dem__since_listed(w, w->step + (h > 0.0));
    ptrdiff_t strays = 0;
    for (ptrdiff_t k = -DEM__AHEAD; k < n; k++) {
        if (k + DEM__AHEAD < n) dem__fetch_flight(w, doubtful[k + DEM__AHEAD]);
        if (k < 0) continue;
        const int32_t i = doubtful[k];
        const dem_vec stray = dem__stray(w, i, t);
        if (dem__holds_course(w, i, stray)) dem__leave_room(w, i, dem__length(stray));
        else doubtful[strays++] = i;
    }
    return strays;
}
static inline void dem__kick_share(dem_world *w, double h, ptrdiff_t first, ptrdiff_t end, double *check, ptrdiff_t *strays) {
    dem__kick_part(w, h, first, end, check, strays);
    *strays = dem__find_strays(w, h, w->remap__ + first, *strays);
}
static inline int dem__kick(dem_world *w, double h) {
    const ptrdiff_t n = w->active_count__;
    const int parts = dem__parts(w, n / 4); /* to move or kick a particle is little work */
    double check[DEM__PARTS_MAX], all = 0.0;
    ptrdiff_t strays[DEM__PARTS_MAX];
    int q;
    if (parts == 1) dem__kick_share(w, h, 0, n, &check[0], &strays[0]);
    else {
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
        for (q = 0; q < parts; q++) dem__kick_share(w, h, dem__part(n, q, parts), dem__part(n, q + 1, parts), &check[q], &strays[q]);
    }
    for (q = 0; q < parts; q++) {
        const int32_t *stray = w->remap__ + dem__part(n, q, parts);
        for (ptrdiff_t k = 0; k < strays[q]; k++) dem__unsettle(w, stray[k]);
        all += check[q];
    }
    return all == 0.0;
}

/* A contact that has just begun turns the normal velocities of its bodies to and fro about that of their centre of mass: what leads there,
   for their courses. */
DEM_INLINE void dem__expect_impact(dem_world *w, ptrdiff_t i, ptrdiff_t j, dem_vec n, double closing) {
    if (!(closing > 0.0)) return; /* it has ended */
    const double part = j < 0 ? 1.0 : w->particle[j].mass / (w->particle[i].mass + w->particle[j].mass);
    w->impact__[i] = dem__scale(part * closing, n);
    if (j >= 0) w->impact__[j] = dem__scale((part - 1.0) * closing, n);
}

/* Impulse and shift of the contact in slot c, which began or ended within the step. */
static inline void dem__settle_event(dem_world *w, int32_t c, int turns) {
    const dem__handed *h = &w->live_handed__[c];
    const int32_t i = w->live_i__[c], j = w->live_j__[c];
    const dem_vec n = dem_vec3(h->n[0], h->n[1], h->n[2]), impulse = dem__first(h->impulse);
    for (int side = 0; side < (j >= 0 ? 2 : 1); side++) {
        const int32_t a = side ? j : i;
        dem__unsettle(w, a);
        dem_particle *p = &w->particle[a];
        const double m = (side ? -1.0 : 1.0) / p->mass;
        p->v = dem__plus(p->v, m, impulse);
        p->x = dem__plus(p->x, m * h->shift, n);
        w->shifted__[a] += fabs(m * h->shift);
        if (!turns) continue;
        const dem_vec torque = dem__first(h->impulse + (side ? 6 : 3));
        p->spin = dem__plus(p->spin, 1.0 / dem__inertia(w, a), torque);
    }
    if (j < 0) {
        const dem_vec place = w->particle[i].x, t = turns ? dem__second(h->impulse) : dem_vec3(0.0, 0.0, 0.0);
        const dem_vec v = dem__sub(w->particle[i].v, dem__surface_velocity(&w->wall[-1 - j], place, n));
        dem__strike_wall(&w->wall[-1 - j], place, dem__scale(-1.0, impulse), dem__scale(-1.0, t));
        dem__expect_impact(w, i, j, n, -dem__dot(v, n));
        return;
    }
    /* a pair that is moved apart turns more slowly, as its angular momentum stays */
    dem_particle *a = &w->particle[i], *b = &w->particle[j];
    const dem_vec d = dem__apart(w, dem__sub(a->x, b->x)), v = dem__sub(a->v, b->v);
    const dem_vec slower = dem__scale(-h->shift / dem__length(d), dem__sub(v, dem__scale(dem__dot(v, n), n)));
    a->v = dem__plus(a->v, 1.0 / a->mass, slower);
    b->v = dem__plus(b->v, -1.0 / b->mass, slower);
    dem__expect_impact(w, i, j, n, -dem__dot(v, n));
}
static inline void dem__settle_events(dem_world *w, int turns) {
    for (const dem__section *in = w->section__; in < w->section__ + w->sections__; in++) {
        for (ptrdiff_t k = 0; k < in->marked; k++) {
            const int32_t c = w->slots__[in->first + k];
            if (w->live_event__[c]) dem__settle_event(w, c, turns);
        }
    }
}

/* What became of a thread's share of the unsettled: how many have new courses, how many of those are to look at a wall sooner, and does
   any begin a flight. */
typedef struct dem__watched {
    ptrdiff_t restarted, hurried;
    int flown;
    dem__news news;
} dem__watched;

/* Ahead of a watch. */
DEM_INLINE void dem__fetch_unsettled(const dem_world *w, ptrdiff_t i) {
    dem__fetch_flight(w, i);
    DEM__PREFETCH(&w->listed_at__[i]);
    DEM__PREFETCH(&w->alive[i]);
    DEM__PREFETCH(&w->touching[i]);
    DEM__PREFETCH(&w->shifted__[i]);
    DEM__PREFETCH(&w->wall_speed__[i]);
    DEM__PREFETCH(&w->wall_timers__.due[i * w->walls]);
    DEM__PREFETCH(&w->wall_sure__[i * w->walls]);
}

/* Unsettled particles first .. end-1: whose velocity left its ball, or whose flight begins, gets a new course and is listed in remap__ from
   `first` on; unsettled__ lists from there those that are to look at a wall sooner. */
static inline void dem__watch_part(dem_world *w, ptrdiff_t first, ptrdiff_t end, dem__watched *q) {
    const dem__list_frame frame = dem__frame_at(w, w->step);
    const double t = dem__since_listed(w, w->step);
    q->restarted = q->hurried = q->flown = 0;
    q->news = dem__no_news(w);
    for (ptrdiff_t k = first - DEM__AHEAD; k < end; k++) {
        if (k + DEM__AHEAD < end) dem__fetch_unsettled(w, w->unsettled__[k + DEM__AHEAD]);
        if (k < first) continue;
        const int32_t i = w->unsettled__[k];
        if (w->alive[i] && !w->stale__) {
            const dem_particle *p = &w->particle[i];
            const dem_vec stray = dem__stray(w, i, t);
            if (w->touching[i] == 0 || !dem__holds_course(w, i, stray)) {
                const double shifted = w->shifted__[i];
                dem__set_course(w, i, w->step, p->x, p->v);
                w->remap__[first + q->restarted++] = i;
                if (dem__heed_course(w, i, w->step, &frame, p->x, p->v, shifted, &q->news)) w->unsettled__[first + q->hurried++] = i;
            } else dem__leave_room(w, i, dem__length(stray));
        }
        w->impact__[i] = dem_vec3(0.0, 0.0, 0.0);
        w->is_active__[i] = w->alive[i] && (w->touching[i] > 0 || (w->loads_on__ && dem__is_loaded(w, i)));
        q->flown |= !w->is_active__[i];
    }
}

/* Courses and timers of the unsettled; those whose flight begins leave the list of active particles. */
static inline void dem__watch(dem_world *w) {
    const ptrdiff_t n = w->unsettled_count__, active = w->active_count__;
    const int parts = dem__parts(w, 4 * n);
    dem__watched watched[DEM__PARTS_MAX];
    ptrdiff_t restarted = 0, kept = 0;
    int q, flown = 0;
    if (parts == 1) dem__watch_part(w, 0, n, &watched[0]);
    else {
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
        for (q = 0; q < parts; q++) dem__watch_part(w, dem__part(n, q, parts), dem__part(n, q + 1, parts), &watched[q]);
    }
    for (q = 0; q < parts; q++) {
        const ptrdiff_t first = dem__part(n, q, parts);
        for (ptrdiff_t k = 0; k < watched[q].hurried; k++) dem__hurry_to_walls(w, w->unsettled__[first + k], w->step);
        for (ptrdiff_t k = 0; k < watched[q].restarted; k++) w->remap__[restarted++] = w->remap__[first + k];
        dem__take_news(w, &watched[q].news);
        flown |= watched[q].flown;
    }
    dem__restart(w, w->remap__, restarted, w->step);
    w->unsettled_count__ = 0;
    if (!flown) return;
    for (ptrdiff_t k = 0; k < active; k++) {
        const int32_t i = w->active__[k];
        w->active__[kept] = i;
        kept += w->is_active__[i] != 0;
    }
    w->active_count__ = kept;
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

/* Looks at the pairs that are due, in sheaves first .. end-1. */
static inline void dem__look_in(dem_world *w, dem__waits *waits, ptrdiff_t first, ptrdiff_t end, int64_t step) {
    int32_t *due = w->pair_timers__.list + first * DEM__SHEAF;
    ptrdiff_t n;
    dem__list_due(&w->pair_timers__, first, end, step, DEM__NEVER, &n);
    dem__no_waits(waits);
    waits->found = due; /* what is found overwrites what has been looked at */
    for (ptrdiff_t k = -2 * DEM__AHEAD; k < n; k++) {
        const ptrdiff_t flight = k + DEM__AHEAD, pair = flight + DEM__AHEAD;
        if (pair < n) DEM__PREFETCH(&w->near__[due[pair]]);
        if (flight >= 0 && flight < n) {
            dem__fetch_flight(w, w->near__[due[flight]].i);
            dem__fetch_flight(w, w->near__[due[flight]].j);
        }
        if (k >= 0) dem__look_at_pair(w, waits, due[k], step);
    }
    dem__set_waits(w, waits, step);
}

/* Threads take sheaves of their own, if about as many pairs are due as in the step before. */
static inline void dem__look_at_due(dem_world *w, int64_t step) {
    const ptrdiff_t sheaves = w->pair_timers__.sheaves;
    const int parts = dem__parts_of(w, w->due__, DEM__SECTIONS);
    dem__waits waits[DEM__SECTIONS];
    int q;
    if (parts == 1) dem__look_in(w, &waits[0], 0, sheaves, step);
    else {
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
        for (q = 0; q < parts; q++) dem__look_in(w, &waits[q], dem__part(sheaves, q, parts), dem__part(sheaves, q + 1, parts), step);
    }
    w->due__ = 0;
    for (q = 0; q < parts; q++) {
        w->due__ += (ptrdiff_t)waits[q].looks;
        dem__bear_found(w, &waits[q]);
    }
}

/* Looks at all pairs that do not touch. */
static inline void dem__look_at_pairs(dem_world *w, int64_t step) {
    dem__waits waits;
    dem__no_waits(&waits);
    waits.found = w->pair_timers__.list;
    for (int32_t p = 0; p < (int32_t)w->near_count__; p++) {
        if (w->pair_timers__.due[p] != DEM__STOPPED) dem__look_at_pair(w, &waits, p, step);
    }
    dem__bear_found(w, &waits);
}

/* Looks at everything whose time has come, at the given step. */
static inline void dem__look(dem_world *w, int64_t step) {
    if (w->meshes__) dem__follow(w, step);
    if (!(w->def.skip & DEM_SKIP_PAIRS)) dem__look_at_pairs(w, step);
    if (!(w->def.skip & DEM_SKIP_SPACE)) {
        for (int32_t e = 0; e < (int32_t)(w->count * w->walls); e++) {
            if (dem__awaits(w, e / w->walls, (int)(e % w->walls))) dem__look_at_wall(w, e, step);
        }
    }
    dem__look_at_due(w, step);
    ptrdiff_t n;
    dem__list_due(&w->wall_timers__, 0, w->wall_timers__.sheaves, step, DEM__STOPPED, &n);
    for (ptrdiff_t k = 0; k < n; k++) dem__look_at_wall(w, w->wall_timers__.list[k], step);
}

/* Takes back what was found in a step that cannot be finished. */
static DEM__APART int dem__undo_look(dem_world *w) {
    for (; w->born__ > 0; w->born__--) {
        const int32_t p = w->live_near__[dem__next_slot(w) - 1];
        w->section__[w->sections__ - 1].live--;
        w->live_count__--;
        if (p >= 0) w->pair_timers__.due[p] = DEM__NEVER;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i] < 0) w->alive[i] = 1, w->passed_count--;
    }
    w->leaving__ = 0;
    for (int k = 0; k < w->walls; k++) dem__move_wall(&w->wall[k], w->time);
    return 0;
}

/* Blocks of links to threads. */
static inline void dem__share_blocks(dem_world *w, dem_kernel_fn kernel, ptrdiff_t count) {
    const ptrdiff_t blocks = (count + DEM_BLOCK - 1) / DEM_BLOCK;
    const int parts = dem__parts(w, count);
    int q;
    if (parts == 1) {
        kernel(w, 0, count);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
    for (q = 0; q < parts; q++) {
        const ptrdiff_t first = DEM_BLOCK * dem__part(blocks, q, parts), end = DEM_BLOCK * dem__part(blocks, q + 1, parts);
        kernel(w, first, end < count ? end : count);
    }
}

/* Adds what the threads that evaluated the contacts could not to the sums of particles low .. high-1. */
static inline void dem__add_later(dem_world *w, int32_t low, int32_t high, int turns) {
    for (const dem__section *in = w->section__; in < w->section__ + w->sections__; in++) {
        dem__deferral *later = w->deferral__ + in->first;
        if (in->deferred == 0 || in->low >= high || in->high < low) continue;
        for (ptrdiff_t k = 0; k < in->deferred; k++, later++) {
            const int32_t from = low > in->own ? low : in->own; /* the rest has been added */
            const int to_i = later->i >= from && later->i < high, to_j = later->j >= from && later->j < high;
            double *out[9];
            for (int a = 0; a < 9; a++) out[a] = &later->out[a];
            dem__add_forces(w, 0, later->i, later->j, out, 0, turns, to_i, to_j);
        }
    }
}

/* A thread adds to particles of the share before the one that it has evaluated (the first of those to the last): nearly all of what waits
   for them it has left itself, and has in its cache. */
static inline void dem__add_deferred(dem_world *w, int turns) {
    const int sections = w->sections__;
    ptrdiff_t n = 0;
    int q;
    for (q = 0; q < sections; q++) n += w->section__[q].deferred;
    const int parts = dem__parts_of(w, n, sections);
    if (parts == 1) {
        dem__add_later(w, 0, INT32_MAX, turns);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
    for (q = 0; q < parts; q++) {
        const int share = (2 * parts - 2 - q) % parts;
        const ptrdiff_t first = dem__part(sections, share, parts), end = dem__part(sections, share + 1, parts);
        dem__add_later(w, w->section__[end - 1].from, first > 0 ? w->section__[first - 1].from : INT32_MAX, turns);
    }
}

/* A thread's share of the sections, the last share the first thread's: it takes them from `next` on, others help it from the end. */
typedef struct dem__stint {
    int first, next, end;
} dem__stint;

/* The next section that a thread is to evaluate: of its own share, else the last of the largest that has more than one left, as that one's
   owner has it in its cache; -1: there is none. A thread adds to sums of particles whose contacts it all has, or has first: those
   before `own`. */
static inline int dem__claim(dem_world *w, dem__stint *stint, int parts, int part) {
    int section = -1;
#ifdef _OPENMP
#pragma omp critical(dem_claim)
#endif
    {
        dem__stint *of = &stint[part];
        const int helps = of->next == of->end;
        for (int q = 0; q < parts && helps; q++) of = stint[q].end - stint[q].next > of->end - of->next ? &stint[q] : of;
        if (of->next + helps < of->end) {
            section = helps ? --of->end : of->next++;
            const int first = helps ? section : of->first;
            w->section__[section].own = first > 0 ? w->section__[first - 1].from : INT32_MAX;
        }
    }
    return section;
}
static inline void dem__evaluate_stint(dem_world *w, dem_kernel_fn kernel, dem__stint *stint, int parts, int part) {
    for (int section = dem__claim(w, stint, parts, part); section >= 0; section = dem__claim(w, stint, parts, part))
        kernel(w, section, section + 1);
}

/* Forces of all contacts and their sums; what each contact did is kept if somebody may ask for it. */
static inline void dem__evaluate(dem_world *w, dem_kernel_fn kernel, double h, int turns, int keep) {
    const int parts = w->deferral__ ? dem__parts_of(w, w->live_count__, w->sections__) : 1;
    dem__stint stint[DEM__SECTIONS];
    int q;
    w->kernel_dt__ = h;
    w->keeps_out__ = keep;
    for (q = 0; q < w->sections__; q++) w->section__[q].own = INT32_MAX;
    if (parts == 1) kernel(w, 0, w->sections__);
    else {
        for (q = 0; q < parts; q++) {
            stint[q].first = stint[q].next = (int)dem__part(w->sections__, parts - 1 - q, parts);
            stint[q].end = (int)dem__part(w->sections__, parts - q, parts);
        }
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
        for (q = 0; q < parts; q++) dem__evaluate_stint(w, kernel, stint, parts, q);
        dem__add_deferred(w, turns);
    }
    for (int k = 0; k < w->walls; k++) {
        dem_wall *wall = &w->wall[k];
        wall->force = wall->torque = dem_vec3(0.0, 0.0, 0.0);
        for (q = 0; q < w->sections__; q++) {
            wall->force = dem__add(wall->force, w->push__[q][k].force);
            wall->torque = dem__add(wall->torque, w->push__[q][k].torque);
        }
        wall->impulse = dem__plus(wall->impulse, h, wall->force);
    }
}

/* All contacts into the order of their particles i, the last first, else as they were: neighbours in space are then read one after the
   other. Many in sections of equal size, with room to grow. */
static inline int dem__tidy(dem_world *w) {
    const ptrdiff_t n = w->live_count__;
    const int sections = n < DEM__SECTIONS * 512 ? 1 : DEM__SECTIONS;
    dem__section section[DEM__SECTIONS];
    dem__array list[DEM__ARRAYS_MAX];
    int32_t *place = w->remap__, sum = 0, before = INT32_MAX;
    ptrdiff_t end = 0, cut = 0;
    int in_order = sections == w->sections__;
    DEM__EACH(w, c) {
        in_order &= before >= w->live_i__[c];
        before = w->live_i__[c];
    }
    if (!in_order) {
        for (ptrdiff_t i = 0; i < w->count; i++) place[i] = 0;
        DEM__EACH(w, c) { place[w->live_i__[c]]++; }
        for (ptrdiff_t i = w->count - 1; i >= 0; i--) {
            const int32_t of = place[i];
            place[i] = sum;
            sum += of;
        }
        DEM__EACH(w, c) { w->slots__[place[w->live_i__[c]]++] = (int32_t)c; }
        memset(section, 0, sizeof section);
        for (int q = 0; q < sections; q++) {
            const ptrdiff_t first = cut;
            if (dem__part(n, q + 1, sections) > cut) cut = dem__part(n, q + 1, sections);
            while (cut < n && w->live_i__[w->slots__[cut]] == w->live_i__[w->slots__[cut - 1]]) cut++;
            section[q].from = q < sections - 1 ? w->live_i__[w->slots__[cut - 1]] : 0;
            section[q].first = end;
            section[q].live = cut - first;
            section[q].room = sections > 1 ? section[q].live + section[q].live / 4 + DEM_BLOCK : 0;
            end += section[q].room;
        }
        if (!dem__grow_live(w, end + 1)) {
            w->status = DEM_OUT_OF_MEMORY;
            return 0;
        }
        dem__arrange(w, n, section, sections, list, dem__held_arrays(w, list));
        w->sections__ = sections;
        memcpy(w->section__, section, sizeof section);
        dem__list_wall_contacts(w);
    }
    return 1;
}

/* Begins a run: lists, contacts that are already there, their forces and so the accelerations. */
static DEM__APART int dem__prepare_run(dem_world *w, const dem_law *law, dem_kernel_fn kernel, int features) {
    ptrdiff_t born = 0;
    if (w->stale__) {
        DEM__EACH(w, c) { /* contacts with walls that were taken away */
            if (w->live_j__[c] < 0 && !w->wall[-1 - w->live_j__[c]].enabled) w->live_ended__[c] = 1;
        }
        dem__bury(w, w->step, 1);
        if (!dem__rebuild(w)) return 0;
    }
    for (int k = 0; k < w->walls; k++) dem__move_wall(&w->wall[k], w->time);
    for (int a = 0; a < w->def.materials; a++) {
        for (int b = 0; b < w->def.materials; b++) {
            const dem_pair_def *pair = dem_pair(&w->def, a, b);
            w->damping_ratio__[a][b] = dem_damping_ratio(pair->restitution, pair->mode);
        }
    }
    if (w->fresh__) {
        int skip = w->def.skip;
        w->def.skip = 0; /* everything, once; the timers stay */
        dem__look_at_pairs(w, w->step);
        for (ptrdiff_t i = 0; i < w->count; i++) {
            for (int k = 0; k < w->walls; k++) {
                if (w->wall[k].kind != DEM_EXIT && dem__awaits(w, i, k)) dem__look_at_wall(w, (int32_t)i * w->walls + k, w->step);
            }
        }
        w->def.skip = skip;
        if (w->status != DEM_OK) return dem__undo_look(w);
        born = w->born__;
        dem__admit_born(w, 0.0);
        dem__list_active(w);
        for (ptrdiff_t k = 0; k < born; k++) {
            const int32_t c = w->slots__[k], i = w->live_i__[c], j = w->live_j__[c];
            if (j < 0 && w->wall[-1 - j].kind != DEM_SCREEN) dem__stop_timer(&w->wall_timers__, i * w->walls - 1 - j);
        }
    }
    if (w->fresh__ || w->features__ != features || w->law__ != law) {
        w->kinds__ = 0;
        DEM__EACH(w, c) { dem__fold_constants(w, c, law, features); }
    }
    w->features__ = features;
    w->law__ = law;
    if (w->fresh__) {
        dem__tell_born(w, law, born);
        if (!dem__tidy(w)) return 0;
        dem__advance(w, 0.0);
        dem__evaluate(w, kernel, 0.0, (features & DEM_FRICTION) != 0, 1);
        if (!dem__kick(w, 0.0)) return dem__fail(w, DEM_NOT_FINITE);
        dem__kick_walls(w, 0.0);
        dem__bury(w, w->step, 0);
        dem__watch(w);
        if (w->status != DEM_OK) return 0;
    }
    w->fresh__ = 0;
    if ((features & DEM_ENERGY) && !w->ledger_started__) {
        w->ledger_started__ = 1;
        dem_energy_ledger now = dem_energy(w);
        w->ledger__.start = now.kinetic + now.rotational + now.elastic + now.potential;
        w->ledger__.start_potential = now.potential;
    }
    return 1;
}

DEM_INLINE double dem__motion_energy(const dem_world *w, ptrdiff_t i) { return dem__kinetic(w, i) + dem__rotational(w, i); }

/* Links by velocity Verlet with a step of their own: their forces are constant between two evaluations, and at each the velocities
   get what the mean of the old force and the new one would have made. */
static inline void dem__step_links(dem_world *w) {
    const double h = (double)w->link_stride__ * w->dt__;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->link_head__[i] < 0 && !w->link_loaded__[i]) continue;
        dem__settle(w, i);
        dem__wrap(w, i);
        if (w->ledger_on__) w->ledger__.link_work += dem__link_work(w, i) - dem__motion_energy(w, i);
        for (int a = 0; a < 6; a++) w->sum__[i].load[a] = w->load__[i][a], w->load__[i][a] = w->external__[i][a];
    }
    w->kernel_dt__ = h;
    dem__share_blocks(w, w->link_kernel__, w->link_count__);
    if (dem__parts(w, w->link_count__) > 1) dem__add_links(w, 0, w->link_count__);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->link_head__[i] < 0 && !w->link_loaded__[i]) continue;
        const dem__sum *sum = &w->sum__[i];
        dem_particle *p = &w->particle[i];
        const dem_vec force = dem__sub(dem__first(w->load__[i]), dem__first(sum->load));
        const dem_vec torque = dem__sub(dem__second(w->load__[i]), dem__second(sum->load));
        const dem_vec a = dem__scale(sum->per_mass, force), b = dem__scale(sum->per_inertia, torque); /* changes */
        w->link_loaded__[i] = w->link_head__[i] >= 0;
        p->v = dem__plus(p->v, 0.5 * h, a), p->a = dem__add(p->a, a);
        p->spin = dem__plus(p->spin, 0.5 * h, b), w->spin_rate[i] = dem__add(w->spin_rate[i], b);
        if (w->ledger_on__) {
            w->ledger__.link_work += dem__motion_energy(w, i);
            for (int q = 0; q < 3; q++) w->linked__[i][q] = dem_axis(p->x, q), w->linked__[i][3 + q] = dem_axis(p->spin, q);
        }
        for (int q = 0; q < 6; q++) w->sum__[i].load[q] = 0.0;
        if (w->stale__) continue;
        const double strayed = dem__length(dem__stray(w, i, dem__since_listed(w, w->step)));
        if (strayed < w->course__[i].ball - dem__link_drift(w, i)) dem__leave_room(w, i, strayed);
        else {
            const int32_t one = (int32_t)i;
            dem__begin_course(w, i, w->step);
            dem__restart(w, &one, 1, w->step);
        }
    }
    for (int32_t k = 0; k < (int32_t)w->link_count__;) {
        if (w->link_ended__[k]) dem__cut_link(w, k);
        else k++;
    }
}

static inline int dem__step(dem_world *w, const dem_law *law, dem_kernel_fn kernel, int features, int keep) {
    const int turns = (features & DEM_FRICTION) != 0;
    if (w->step % DEM__TIDY == 0 && !dem__tidy(w)) return 0;
    if (w->step >= w->next_check__ && !dem__check_list(w)) return 0;
    if (!dem__move_walls(w, w->step + 1)) w->status = DEM_NOT_FINITE;
    else dem__look(w, w->step + 1);
    if (w->status != DEM_OK) return dem__undo_look(w);
    if (w->born__) {
        const ptrdiff_t born = w->born__;
        dem__admit_born(w, 1.0);
        dem__advance(w, w->dt__);
        for (ptrdiff_t k = 0; k < born; k++) dem__fold_constants(w, w->slots__[k], law, features);
        dem__tell_born(w, law, born);
    } else dem__advance(w, w->dt__);
    dem__evaluate(w, kernel, w->dt__, turns, keep);
    if (features & DEM_ENERGY) dem__gather_losses(w);
    const int finite = dem__kick(w, w->dt__);
    dem__kick_walls(w, w->dt__);
    dem__settle_events(w, turns);
    w->particle_steps += w->count - w->dropped__;
    w->contact_steps += w->live_count__;
    w->step++;
    w->time = w->start_time__ + (double)(w->step - w->start_step__) * w->dt__;
    if (!finite) return dem__fail(w, DEM_NOT_FINITE);
    const int leaving = w->leaving__;
    if (leaving) {
        DEM__EACH(w, c) {
            const ptrdiff_t j = w->live_j__[c];
            if (w->alive[w->live_i__[c]] < 0 || (j >= 0 && w->alive[j] < 0)) w->live_ended__[c] = 1;
        }
        for (ptrdiff_t i = 0; i < w->count; i++) {
            if (w->alive[i] < 0) dem__forget(w, i);
        }
        w->leaving__ = 0;
    }
    dem__bury(w, w->step, leaving);
    if (leaving) dem__let_go(w);
    dem__watch(w);
    if (w->link_stride__ > 0 && w->step % w->link_stride__ == 0) dem__step_links(w);
    return w->status == DEM_OK;
}

/* A kernel says so of no contacts if it is not for this law and these features. */
static inline int dem__fits(dem_world *w, const dem_law *law, dem_kernel_fn kernel, int features) {
    const dem_law *old_law = w->law__;
    const int old_features = w->features__;
    w->law__ = law, w->features__ = features;
    kernel(w, 0, 0);
    const int fits = w->status == DEM_OK;
    w->law__ = old_law, w->features__ = old_features;
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
    double remaining = (w->target__ + duration - w->time) / w->dt__;
    if (!(remaining < 9e15)) return DEM_BAD_ARGUMENT;
    if (w->status != DEM_OK) return w->status;
    if (!dem__fits(w, law, kernel, features)) return DEM_BAD_ARGUMENT;
    for (int k = 0; k < w->walls; k++) {
        if (w->wall[k].drive == DEM_PRESCRIBED && !w->wall[k].motion) return DEM_NO_MOTION;
    }
    const double narrowest = dem__narrowest(w);
    for (ptrdiff_t i = 0; i < w->count && narrowest < HUGE_VAL; i++) {
        if (w->alive[i] && !(narrowest > 4.4 * w->particle[i].radius)) return DEM_BAD_DEFINITION;
    }
    if (law->states != w->states__ && w->live_count__ > 0) return DEM_LAW_MISMATCH;
    if (w->link_count__ > 0 && !w->link_law__) return DEM_LAW_MISMATCH; /* loaded: dem_set_links comes first */
    const int ledger = w->ledger_on__ || (features & DEM_ENERGY),
              constants = law->constants > w->constants__ ? law->constants : w->constants__;
    const int deferrals = dem__has_deferrals(w) && !w->deferral__;
    if (law->states != w->states__ || constants != w->constants__ || ledger != w->ledger_on__ ||
        deferrals) { /* other arrays: a new block */
        dem__array list[DEM__ARRAYS_MAX];
        const int old_states = w->states__, old_constants = w->constants__, old_ledger = w->ledger_on__;
        const ptrdiff_t old_capacity = w->live_capacity__;
        w->states__ = law->states, w->constants__ = constants, w->ledger_on__ = ledger;
        if (!dem__grow_group(w, list, dem__live_arrays(w, list), &w->live_block__, &w->live_bytes__, &w->live_capacity__,
                             dem__next_slot(w) + 1)) {
            w->states__ = old_states, w->constants__ = old_constants, w->ledger_on__ = old_ledger;
            w->live_capacity__ = old_capacity;
            return DEM_OUT_OF_MEMORY;
        }
        for (int a = w->states__; a < DEM_STATE_MAX; a++) w->live_state__[a] = NULL; /* not in the block */
    }
    if (!dem__prepare_run(w, law, kernel, features)) return w->status;
    w->target__ += duration;
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

DEM_API dem_status dem_run(dem_world *world, double duration, int features) {
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
