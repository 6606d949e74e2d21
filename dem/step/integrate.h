/* Motion of particles within a step, and how it changes their bounds. Reads forces, walls, the list; writes bodies and
   timers. Promises: a particle whose velocity left its bound has a new one before the next step. */
#pragma once
#include "../motion/fixed.h"
#include "../contacts/contacts.h"

/* Returns where prefetching ends among active particles first .. end-1. It pays only where active particles are few and
   so lie far apart in memory. */
DEM_INLINE ptrdiff_t dem__prefetch_until(const dem_world *w, ptrdiff_t first, ptrdiff_t end) {
    return 4 * w->engine->bodies.active_count < w->count ? end - DEM__AHEAD : first;
}

/* The periodic box, which is infinite along the other axes. */
typedef struct dem__box {
    dem_vec low, high;
} dem__box;
DEM_INLINE dem__box dem__periodic_box(const dem_world *w) {
    dem__box b;
    b.low = dem_vec3(-HUGE_VAL, -HUGE_VAL, -HUGE_VAL), b.high = dem_vec3(HUGE_VAL, HUGE_VAL, HUGE_VAL);
    for (int a = 0; a < 3; a++) {
        if (!w->def.periodic[a]) continue;
        *dem_axis_of(&b.low, a) = dem_axis(w->def.low, a), *dem_axis_of(&b.high, a) = dem_axis(w->def.high, a);
    }
    return b;
}
/* Moves sphere i to the end of the step, and its velocities to its middle. turns: a constant, 0 where spins do not
   change. */
DEM_INLINE void dem__advance_sphere(dem_world *w, ptrdiff_t i, double h, const dem__box *b, int turns) {
    dem_particle *p = &w->particle[i];
    const double t = (double)(w->step + (h > 0.0) - p->origin) * w->engine->run.dt, middle = t - 0.5 * h;
    p->x = dem__sphere_at(w, i, t), p->v = dem__sphere_velocity_at(w, i, middle);
    if (turns) p->spin = dem__sphere_spin_at(w, i, middle);
    p->origin = w->step; /* for hooks, which see the present step */
    const int inside = (p->x.x >= b->low.x) & (p->x.x < b->high.x) & (p->x.y >= b->low.y) & (p->x.y < b->high.y) &
                       (p->x.z >= b->low.z) & (p->x.z < b->high.z);
    if (!inside && w->engine->run.has_periodic) dem__put_in_box(w, i, &p->x);
}
DEM_INLINE void dem__advance_spheres(dem_world *w, double h, ptrdiff_t first, ptrdiff_t end, int turns) {
    const ptrdiff_t apart = dem__prefetch_until(w, first, end);
    const dem__box b = dem__periodic_box(w);
    for (ptrdiff_t k = first; k < end; k++) {
        if (k < apart) dem__prefetch_particle(w, w->engine->bodies.active[k + DEM__AHEAD]);
        dem__advance_sphere(w, w->engine->bodies.active[k], h, &b, turns);
    }
}
DEM_INLINE void dem__advance_turning_or_not(dem_world *w, double h, ptrdiff_t first, ptrdiff_t end) {
    if (w->engine->run.turns) dem__advance_spheres(w, h, first, end, 1);
    else dem__advance_spheres(w, h, first, end, 0);
}
DEM__AVX2_CLONE(dem__advance_part, (dem_world * w, double h, ptrdiff_t first, ptrdiff_t end), (w, h, first, end),
                dem__advance_turning_or_not(w, h, first, end))
static inline void dem__advance_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *h) {
    (void)part;
    dem__advance_part(w, *(const double *)h, first, end);
}
static inline void dem__advance(dem_world *w, double h) {
    const ptrdiff_t n = w->engine->bodies.active_count;
    const int books =
        w->engine->ledger.on && w->engine->run.has_periodic; /* wraps are booked in one sum, by one thread */
    dem__in_parts(w, books ? 1 : dem__parts(w, n / 2), n,    /* n / 2: little work for each particle */
                  w->engine->bodies.rigid ? w->engine->bodies.calls->advance : dem__advance_range, &h);
}

/* Returns the deviation of particle i from its bound [m/s]. t: time of the bounds at which its velocity is known
   [s]. */
DEM_INLINE dem_vec dem__deviation(const dem_world *w, ptrdiff_t i, double t) {
    const dem__bound *c = &w->engine->bodies.bound[i];
    return dem__sub(dem__plus(w->particle[i].v, -t, dem__free_fall(w)), dem_vec3(c->ux, c->uy, c->uz));
}

/* Returns the deviation at the end of the next step. Between the two it changes linearly. */
DEM_INLINE dem_vec dem__next_deviation(const dem_world *w, ptrdiff_t i, dem_vec d) {
    return dem__plus(d, w->engine->run.dt, dem__sub(w->particle[i].a, dem__free_fall(w)));
}

/* Returns whether a particle with deviation d is within its tolerances to the end of the next step. */
DEM_INLINE int dem__within_bound(const dem_world *w, ptrdiff_t i, dem_vec d) {
    const dem__bodies *bodies = &w->engine->bodies;
    const dem_vec e = dem__next_deviation(w, i, d);
    const double tolerance = bodies->bound[i].tolerance * bodies->bound[i].tolerance;
    return dem__dot(d, d) < tolerance && dem__dot(e, e) < tolerance &&
           bodies->shifted[i] < w->engine->pairs.position_tolerance; /* false for NaN */
}

/* Subtracts the greatest change of velocity in this step from tolerance_left__. Returns whether the rest suffices for
   the next step, too. */
DEM_INLINE int dem__surely_within(dem_particle *p, double dt, dem_vec pull) {
    const double way = dem__most_change(dt, pull);
    p->tolerance_left__ -= way;
    return p->tolerance_left__ > 0.5 * way; /* false for NaN */
}

/* Computes new accelerations of active particles first .. end-1, moves their velocities from the middle of the step to
   its end, and sets the sums of forces to zero for the next step. Lists particles that may leave their tolerances in
   scratch.index from `first` on. check: 0, or NaN if a force is not finite. deviating: length of the list. loads,
   turns: constants, 0 where nothing has a load, and where no spin changes. */
DEM_INLINE void dem__kick_all(dem_world *w, double h, ptrdiff_t first, ptrdiff_t end, double *check,
                              ptrdiff_t *deviating, int loads, int turns) {
    dem__bodies *bodies = &w->engine->bodies;
    const int64_t step = w->step + (h > 0.0);
    const double half = 0.5 * h;
    const double dt = w->engine->run.dt;
    const dem_vec gravity = dem__free_fall(w);
    int32_t *doubtful = w->engine->scratch.index + first;
    const ptrdiff_t apart = dem__prefetch_until(w, first, end);
    double all = 0.0;
    ptrdiff_t n = 0;
    for (ptrdiff_t k = first; k < end; k++) {
        const ptrdiff_t i = bodies->active[k];
        if (k < apart) dem__prefetch_body(w->particle, bodies->sum, bodies->active[k + DEM__AHEAD]);
        dem__sum *sum = &bodies->sum[i];
        dem_particle *p = &w->particle[i];
        dem_vec force = dem__first(sum->load), torque = dem__second(sum->load), turn = dem_vec3(0.0, 0.0, 0.0), pull;
        if (loads) {
            force = dem__add(force, dem__first(bodies->load[i]));
            torque = dem__add(torque, dem__second(bodies->load[i]));
        }
        if (loads && dem__note_fixed_force(w, i, force, torque, half))
            pull = dem__scale(-1.0, gravity), torque = dem_vec3(0.0, 0.0, 0.0);
        else pull = dem__scale(sum->per_mass, force);
        p->a = dem__add(gravity, pull);
        p->v = dem__flushed_vec(dem__plus(p->v, half, p->a));
        if (turns) {
            w->spin_rate[i] = turn = dem__scale(sum->per_inertia, torque);
            p->spin = dem__flushed_vec(dem__plus(p->spin, half, turn));
        }
        p->origin = step;
        for (int a = 0; a < (turns ? 6 : 3); a++) sum->load[a] = 0.0;
        all += pull.x + pull.y + pull.z + turn.x + turn.y + turn.z;
        doubtful[n] = (int32_t)i; /* no branch, because it would be mispredicted */
        n += !dem__surely_within(p, dt, pull);
    }
    *check = 0.0 * all;
    *deviating = n;
}
/* Calls dem__kick_all with constants, so that the loop without loads or rotation computes neither. */
DEM_INLINE void dem__kick_loaded_or_not(dem_world *w, double h, ptrdiff_t first, ptrdiff_t end, double *check,
                                        ptrdiff_t *deviating) {
    if (w->engine->bodies.adds_loads) dem__kick_all(w, h, first, end, check, deviating, 1, 1);
    else if (w->engine->run.turns) dem__kick_all(w, h, first, end, check, deviating, 0, 1);
    else dem__kick_all(w, h, first, end, check, deviating, 0, 0);
}
DEM__AVX2_CLONE(dem__kick_part,
                (dem_world * w, double h, ptrdiff_t first, ptrdiff_t end, double *check, ptrdiff_t *deviating),
                (w, h, first, end, check, deviating), dem__kick_loaded_or_not(w, h, first, end, check, deviating))

/* Moves those of n particles that leave their tolerances to the front of the list, and returns how many. Renews
   tolerance_left__ of the others. */
static inline ptrdiff_t dem__find_deviating(dem_world *w, double h, int32_t *doubtful, ptrdiff_t n) {
    const double t = dem__since_listed(w, w->step + (h > 0.0));
    ptrdiff_t deviating = 0;
    for (ptrdiff_t k = dem__prefetch_from(n, DEM__AHEAD); k < n; k++) {
        if (k + DEM__AHEAD < n) dem__prefetch_flight(w, doubtful[k + DEM__AHEAD]);
        if (k < 0) continue;
        const int32_t i = doubtful[k];
        const dem_vec deviation = dem__deviation(w, i, t);
        if (dem__within_bound(w, i, deviation)) dem__set_tolerance_left(w, i, dem__length(deviation));
        else doubtful[deviating++] = i;
    }
    return deviating;
}
/* Marks n particles that are not part of a body, and moves those that were not marked before to the front of the list.
   Returns how many. */
static inline ptrdiff_t dem__mark_deviating(dem_world *w, int32_t *particle, ptrdiff_t n) {
    int32_t *activity = w->engine->bodies.activity;
    ptrdiff_t marked = 0;
    for (ptrdiff_t k = 0; k < n; k++) {
        const int32_t i = particle[k];
        if (activity[i] != DEM__STEPPING) continue;
        activity[i] = DEM__TO_CHECK;
        particle[marked++] = i;
    }
    return marked;
}
typedef struct dem__kicked {
    double h, check[DEM__PARTS_MAX]; /* check: 0, or NaN if a force is not finite */
    ptrdiff_t deviating[DEM__PARTS_MAX];
    int bodies; /* whether there are rigid bodies, whose particles one thread marks together */
} dem__kicked;
static inline void dem__kick_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    dem__kicked *kicked = (dem__kicked *)context;
    dem__kick_part(w, kicked->h, first, end, &kicked->check[part], &kicked->deviating[part]);
    kicked->deviating[part] =
        dem__find_deviating(w, kicked->h, w->engine->scratch.index + first, kicked->deviating[part]);
    if (!kicked->bodies)
        kicked->deviating[part] = dem__mark_deviating(w, w->engine->scratch.index + first, kicked->deviating[part]);
}

/* Returns whether spins may change in the steps of this run. */
static inline int dem__may_turn(const dem_world *w) {
    const dem__feature *f = w->engine->feature;
    int may = w->engine->run.has_friction || w->engine->bodies.adds_loads;
    for (int k = 0; k < w->engine->features; k++) may |= f[k].turns || f[k].add_forces;
    return may;
}

/* Moves the velocities of active particles to the end of the step, and marks those that leave their bounds. Returns 0
   if a force is not finite. */
static inline int dem__kick(dem_world *w, double h) {
    const ptrdiff_t n = w->engine->bodies.active_count;
    const int parts = dem__parts(w, n / 2);
    dem__kicked kicked;
    double all = 0.0;
    if (n == 0) return 1;
    kicked.h = h, kicked.bodies = w->engine->bodies.rigid != NULL;
    DEM__TELL(w, kick, (w, h));
    dem__in_parts(w, parts, n, dem__kick_range, &kicked);
    for (int q = 0; q < parts; q++) {
        const int32_t *particle = w->engine->scratch.index + dem__part(n, q, parts);
        dem__bodies *bodies = &w->engine->bodies;
        for (ptrdiff_t k = 0; k < kicked.deviating[q] && kicked.bodies; k++) dem__mark_to_check(w, particle[k]);
        for (ptrdiff_t k = 0; k < kicked.deviating[q] && !kicked.bodies; k++)
            bodies->to_check[bodies->to_check_count++] = particle[k];
        all += kicked.check[q];
    }
    w->engine->run.turns = dem__may_turn(w); /* without rotation no particle has a spin rate from here on */
    DEM__TELL(w, kicked, (w));
    return all == 0.0;
}

/* Applies the impulse and the shift of the contact in slot c, which began or ended within the step. marks: whether to
   mark its particles for a check of their bounds. */
static inline void dem__apply_correction(dem_world *w, int32_t c, int has_friction, int marks) {
    dem__contacts *contacts = &w->engine->contacts;
    const dem__correction *h = &contacts->correction[c];
    const int32_t i = contacts->i[c], j = contacts->j[c];
    if (dem__has_body(w, i, j)) {
        w->engine->bodies.calls->push(w, c, has_friction);
        return;
    }
    const dem_vec n = dem_vec3(h->n[0], h->n[1], h->n[2]), impulse = dem__first(h->impulse);
    for (int side = 0; side < (j >= 0 ? 2 : 1); side++) {
        const int32_t a = side ? j : i;
        const dem_vec turn = has_friction ? dem__first(h->impulse + (side ? 6 : 3)) : dem_vec3(0.0, 0.0, 0.0);
        if (dem__strike_fixed(w, a, dem__scale(side ? -1.0 : 1.0, impulse), turn)) continue;
        if (marks) dem__mark_to_check(w, a);
        dem_particle *p = &w->particle[a];
        const double m = (side ? -1.0 : 1.0) / p->mass;
        p->v = dem__plus(p->v, m, impulse);
        p->x = dem__plus(p->x, m * h->shift, n);
        w->engine->bodies.shifted[a] += fabs(m * h->shift);
        if (has_friction) p->spin = dem__plus(p->spin, 1.0 / dem__inertia(w, a), turn);
    }
    if (j < 0) {
        const dem_vec place = w->particle[i].x, t = has_friction ? dem__second(h->impulse) : dem_vec3(0.0, 0.0, 0.0);
        const dem_vec v = dem__sub(w->particle[i].v, dem__surface_velocity(&w->wall[-1 - j], place, n));
        dem__strike_wall(&w->wall[-1 - j], place, n, dem__scale(-1.0, impulse), dem__scale(-1.0, t));
        dem__expect_impact(w, i, j, n, -dem__dot(v, n));
        return;
    }
    /* keeps angular momentum: a pair that is moved apart turns more slowly */
    dem_particle *a = &w->particle[i], *b = &w->particle[j];
    const dem_vec d = dem__nearest_image(w, dem__sub(a->x, b->x)), v = dem__sub(a->v, b->v);
    const dem_vec slower = dem__scale(-h->shift / dem__length(d), dem__sub(v, dem__scale(dem__dot(v, n), n)));
    a->v = dem__plus(a->v, dem__per_mass(w, i), slower);
    b->v = dem__plus(b->v, -dem__per_mass(w, j), slower);
    dem__expect_impact(w, i, j, n, -dem__dot(v, n));
}
/* Returns whether the contact in slot c changes only two spheres whose own contacts are in chunk q. */
DEM_INLINE int dem__is_inner(const dem_world *w, ptrdiff_t q, int32_t c) {
    const dem__chunk *in = &w->engine->contacts.chunk[q];
    const int32_t i = w->engine->contacts.i[c], j = w->engine->contacts.j[c], *rank = w->engine->bodies.rank;
    const int32_t stop = q > 0 ? in[-1].first_rank : INT32_MAX;
    if (j < 0 || !dem__is_free_sphere(w, i) || !dem__is_free_sphere(w, j)) return 0;
    return rank[i] >= in->first_rank && rank[i] < stop && rank[j] >= in->first_rank && rank[j] < stop;
}
/* Prefetches what the correction of the contact in slot c writes. */
DEM_INLINE void dem__prefetch_correction(const dem_world *w, int32_t c) {
    dem__prefetch_flight(w, w->engine->contacts.i[c]);
    if (w->engine->contacts.j[c] >= 0) dem__prefetch_flight(w, w->engine->contacts.j[c]);
    DEM__PREFETCH(&w->engine->contacts.correction[c]);
}
static inline void dem__correct_inner_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *friction) {
    dem__contacts *contacts = &w->engine->contacts;
    (void)part;
    for (ptrdiff_t q = first; q < end; q++) {
        const int32_t *slot = contacts->slots + contacts->chunk[q].first;
        const ptrdiff_t n = contacts->chunk[q].marked;
        for (ptrdiff_t k = 0; k < n; k++) dem__prefetch_correction(w, slot[k]);
        for (ptrdiff_t k = 0; k < n; k++) {
            if (!contacts->partial[slot[k]] || !dem__is_inner(w, q, slot[k])) continue;
            dem__apply_correction(w, slot[k], *(const int *)friction, 0);
            contacts->partial[slot[k]] = 2; /* corrected; its particles are still to be marked */
        }
    }
}
/* Applies the corrections of contacts between chunks, and marks the particles of the others. */
static inline void dem__correct_others(dem_world *w, int has_friction) {
    const dem__contacts *contacts = &w->engine->contacts;
    int32_t waits[DEM__BLOCK]; /* contacts whose memory is being fetched */
    int n = 0;
    for (const dem__chunk *in = contacts->chunk; in < contacts->chunk + contacts->chunk_count; in++) {
        for (ptrdiff_t k = 0; k < in->marked; k++) {
            const int32_t c = contacts->slots[in->first + k];
            if (contacts->partial[c] == 2) dem__mark_one(w, contacts->i[c]), dem__mark_one(w, contacts->j[c]);
            if (contacts->partial[c] != 1) continue;
            dem__prefetch_correction(w, c);
            waits[n++] = c;
            for (int m = 0; m < n && n == DEM__BLOCK; m++) dem__apply_correction(w, waits[m], has_friction, 1);
            n = n == DEM__BLOCK ? 0 : n;
        }
    }
    for (int m = 0; m < n; m++) dem__apply_correction(w, waits[m], has_friction, 1);
}
/* Applies the corrections of all partial steps. With chunks, those within one chunk come first, so that threads share
   them. */
static inline void dem__apply_corrections(dem_world *w, int has_friction) {
    const dem__contacts *contacts = &w->engine->contacts;
    const int chunks = contacts->chunk_count;
    ptrdiff_t marked = 0;
    for (int q = 0; q < chunks; q++) marked += contacts->chunk[q].marked;
    if (marked == 0) return;
    if (chunks > 1)
        dem__in_parts(w, dem__parts_of(w, 8 * marked, chunks), chunks, dem__correct_inner_range, &has_friction);
    dem__correct_others(w, has_friction);
    DEM__TELL(w, corrected, (w));
}

/* What a thread found in its share of to_check: how many particles have new bounds, how many of these need earlier wall
   timers, and whether a flight begins. */
typedef struct dem__checked {
    ptrdiff_t reset, earlier;
    int flown;
    dem__outcome outcome;
} dem__checked;

/* Prefetches what the check of a bound reads. */
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

/* Checks particles first .. end-1 of to_check. A particle whose velocity left its tolerance, or whose flight begins,
   gets a new bound and is listed in scratch.index. The others get a new tolerance_left__. */
static inline void dem__check_bounds_part(dem_world *w, ptrdiff_t first, ptrdiff_t end, dem__checked *q) {
    dem__bodies *bodies = &w->engine->bodies;
    const dem__list_frame frame = dem__frame_at(w, w->step);
    const double t = dem__since_listed(w, w->step);
    q->reset = q->earlier = q->flown = 0;
    q->outcome = dem__no_outcome(w);
    for (ptrdiff_t k = first + dem__prefetch_from(end - first, DEM__AHEAD); k < end; k++) {
        if (k + DEM__AHEAD < end) dem__prefetch_check(w, bodies->to_check[k + DEM__AHEAD]);
        if (k < first) continue;
        const int32_t i = bodies->to_check[k];
        if (w->alive[i] && !w->engine->run.needs_lists) {
            const dem_particle *p = &w->particle[i];
            const dem_vec deviation = dem__deviation(w, i, t);
            if (w->touching[i] == 0)
                dem__free_acceleration(w, i); /* no contact force, whatever the law of an ended one returned */
            if (w->touching[i] == 0 || !dem__within_bound(w, i, deviation)) {
                const double shifted = bodies->shifted[i];
                dem__set_bound(w, i, w->step, p->x, p->v);
                w->engine->scratch.index[first + q->reset++] = i;
                if (dem__apply_bound(w, i, w->step, &frame, p->x, p->v, shifted, &q->outcome))
                    w->engine->pairs.cell_of[first + q->earlier++] = i;
            } else dem__set_tolerance_left(w, i, dem__length(deviation));
        }
        bodies->impact[i] = dem_vec3(0.0, 0.0, 0.0);
        bodies->activity[i] = w->alive[i] && (w->touching[i] > 0 || (bodies->loads_on && dem__is_loaded(w, i)));
        q->flown |= !bodies->activity[i];
    }
}

static inline void dem__check_bounds_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *checked) {
    dem__check_bounds_part(w, first, end, (dem__checked *)checked + part);
}

/* Removes a particle whose flight has begun from the list of active ones. The last of the list takes its place. */
DEM_INLINE void dem__drop_active(dem_world *w, ptrdiff_t i) {
    dem__bodies *bodies = &w->engine->bodies;
    const int32_t last = bodies->active[--bodies->active_count], at = bodies->active_at[i];
    bodies->active[at] = last, bodies->active_at[last] = at;
}

/* Checks the bounds of the marked particles, and sets new bounds and timers. Particles that begin a flight leave the
   active list. */
static inline void dem__check_bounds(dem_world *w) {
    dem__bodies *bodies = &w->engine->bodies;
    const ptrdiff_t n = bodies->to_check_count;
    const int parts = dem__parts(w, 4 * n);
    dem__checked watched[DEM__PARTS_MAX];
    ptrdiff_t reset = 0;
    int flown = 0;
    dem__in_parts(w, parts, n, dem__check_bounds_range, watched);
    for (int q = 0; q < parts; q++) {
        const ptrdiff_t first = dem__part(n, q, parts);
        for (ptrdiff_t k = 0; k < watched[q].earlier; k++)
            dem__advance_wall_timers(w, w->engine->pairs.cell_of[first + k], w->step);
        for (ptrdiff_t k = 0; k < watched[q].reset; k++)
            w->engine->scratch.index[reset++] = w->engine->scratch.index[first + k];
        dem__apply_outcome(w, &watched[q].outcome);
        flown |= watched[q].flown;
    }
    dem__reset_pair_timers(w, w->engine->scratch.index, reset, w->step);
    for (ptrdiff_t k = 0; k < n && flown; k++) {
        if (!bodies->activity[bodies->to_check[k]]) dem__drop_active(w, bodies->to_check[k]);
    }
    bodies->to_check_count = 0;
    if (flown && 2 * bodies->active_count > w->count && w->step % 64 == 0) dem__list_active(w);
}
