/* Links, which have a step of their own: setting them and adding one, and their step. Reads bodies and the law of
   links; writes links, the loads and velocities of bodies. The engine calls links.step, which dem_set_links sets: a
   program without links compiles none of it. */
#pragma once
#include "../step/integrate.h"

/* Runs the links' loop on blocks first .. end - 1. */
static inline void dem__evaluate_links_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__links *links = &w->engine->links;
    (void)context;
    links->loop(w, DEM__BLOCK * first, DEM__BLOCK * end < links->count ? DEM__BLOCK * end : links->count, part);
}
static inline void dem__evaluate_links(dem_world *w) {
    const ptrdiff_t n = w->engine->links.count;
    dem__in_parts(w, dem__link_parts(w), (n + DEM__BLOCK - 1) / DEM__BLOCK, dem__evaluate_links_range, NULL);
}

/* Returns whether particle i has links, or its load contains forces of links. */
DEM_INLINE int dem__is_linked(const dem_world *w, ptrdiff_t i) {
    return w->engine->links.first_link[i] >= 0 || w->engine->links.is_loaded[i];
}

/* Returns the kinetic energy of a sphere whose origin is the present step [J]. */
DEM_INLINE double dem__energy_at_origin(const dem_world *w, ptrdiff_t i) {
    const dem_particle *p = &w->particle[i];
    return 0.5 * p->mass * dem__dot(p->v, p->v) + 0.5 * dem__inertia(w, i) * dem__dot(p->spin, p->spin);
}

/* Makes the present step the origin of a linked particle, books the work of its links until now, and moves its load to
   the sums. */
static inline void dem__stop_linked(dem_world *w, ptrdiff_t i) {
    dem__bodies *bodies = &w->engine->bodies;
    dem__rigid *r = dem__rigid_of(w, i);
    const dem_particle *p = &w->particle[i];
    dem__set_origin(w, i);
    if (r) bodies->calls->wrap(w, r), bodies->calls->place(w, r);
    else dem__wrap(w, i);
    if (w->engine->ledger.on && r) dem__book_link_work(w, dem__link_work(w, i));
    else if (w->engine->ledger.on && !dem__is_fixed(w, i)) {
        const double work = w->engine->links.is_loaded[i] ? dem__link_work_until(w, i, p->x, p->spin) : 0.0;
        dem__book_link_work(w, work - dem__energy_at_origin(w, i));
    }
    memcpy(bodies->sum[i].load, bodies->load[i], sizeof bodies->load[i]);
    memcpy(bodies->load[i], bodies->external[i], sizeof bodies->load[i]);
}

/* Applies half of the change of its links' forces to a particle; the old forces are in the sums. A body is kicked at
   its first linked particle. */
static inline void dem__kick_linked(dem_world *w, ptrdiff_t i, double half) {
    const dem__sum *sum = &w->engine->bodies.sum[i];
    const double *load = w->engine->bodies.load[i];
    dem__rigid *r = dem__rigid_of(w, i);
    dem_particle *p = &w->particle[i];
    if (dem__is_fixed(w, i)) return;
    if (r) {
        for (ptrdiff_t k = r->first; k < i; k++) {
            if (dem__is_linked(w, k)) return;
        }
        dem__book_link_work(w, -dem__motion_energy(w, r->first));
        w->engine->bodies.calls->kick_links(w, r, half);
        dem__book_link_work(w, dem__motion_energy(w, r->first));
        return;
    }
    const dem_vec a = dem__scale(sum->per_mass, dem__sub(dem__first(load), dem__first(sum->load)));
    const dem_vec b = dem__scale(sum->per_inertia, dem__sub(dem__second(load), dem__second(sum->load)));
    p->v = dem__flushed_vec(dem__plus(p->v, half, a)), p->a = dem__add(p->a, a);
    p->spin = dem__flushed_vec(dem__plus(p->spin, half, b)), w->spin_rate[i] = dem__add(w->spin_rate[i], b);
    if (w->engine->ledger.on) dem__book_link_work(w, dem__energy_at_origin(w, i));
}

/* Keeps the bound of a particle whose links have been evaluated if it holds until the next evaluation; otherwise sets a
   new one. */
static inline void dem__check_linked(dem_world *w, ptrdiff_t i) {
    const double strayed = dem__length(dem__deviation(w, i, dem__since_listed(w, w->step)));
    if (strayed < w->engine->bodies.bound[i].tolerance - dem__link_drift(w, i)) dem__set_tolerance_left(w, i, strayed);
    else {
        const int32_t one = (int32_t)i;
        dem__renew_bound(w, i, w->step);
        dem__reset_pair_timers(w, &one, 1, w->step);
    }
}

/* Advances links by velocity Verlet with a step of their own. Their forces are constant between two evaluations; each
   evaluation corrects the velocities to the mean of the old force and the new one. */
static inline void dem__step_links(dem_world *w) {
    dem__run *run = &w->engine->run;
    dem__bodies *bodies = &w->engine->bodies;
    dem__links *links = &w->engine->links;
    int32_t *linked = w->engine->scratch.index;
    ptrdiff_t n = 0;
    const double h = (double)links->every * run->dt;
    for (int32_t i = 0; i < (int32_t)w->count; i++) {
        linked[n] = i;
        n += dem__is_linked(w, i);
    }
    for (ptrdiff_t q = 0; q < n; q++) dem__stop_linked(w, linked[q]);
    run->kernel_dt = h;
    links->evaluated_step = w->step;
    dem__evaluate_links(w);
    if (dem__link_parts(w) > 1) dem__add_links(w, 0, links->count);
    for (ptrdiff_t q = 0; q < n; q++) dem__kick_linked(w, linked[q], 0.5 * h);
    for (ptrdiff_t q = 0; q < n; q++) { /* after all particles of a body have changed */
        const int32_t i = linked[q];
        const dem__pieces own = dem__pieces_of(w, i);
        const dem_particle *p = &w->particle[i];
        for (int a = 0; a < 6; a++) bodies->sum[i].load[a] = 0.0;
        links->is_loaded[i] = links->first_link[i] >= 0;
        if (w->engine->ledger.on)
            memcpy(links->evaluated_at[i], &p->x, sizeof p->x),
                memcpy(links->evaluated_at[i] + 3, &p->spin, sizeof p->spin);
        if (run->needs_lists) continue;
        for (ptrdiff_t k = own.first; k < own.end; k++) dem__check_linked(w, k);
    }
    for (int32_t k = 0; k < (int32_t)links->count;) {
        if (links->ended[k]) dem__cut_link(w, k);
        else k++;
    }
}

DEM_API dem_status dem_set_links(dem_world *world, const dem_link_kernel *kernel, double interval, double near) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (!w || !w->def.allocator.fn || !kernel || !kernel->loop || !dem__is_law(kernel->law) ||
        !dem__positive(interval) || !dem__not_negative(near) || w->engine->field.on)
        return DEM_BAD_ARGUMENT;
    dem__links *links = &w->engine->links;
    const dem_law *law = kernel->law;
    if (links->count > 0 && (law->states != links->states || !dem__is_of_law(links->mark, law)))
        return DEM_LAW_MISMATCH;
    dem__pieces others = dem__all_particles(w); /* whose work is counted with another interval from now on */
    if (links->on && links->interval == interval) others.end = others.first; /* a loaded world whose law is set again */
    links->on = 1;
    links->law = law, links->mark = dem__law_mark(law);
    links->loop = kernel->loop, links->step = dem__step_links;
    links->interval = interval;
    if (links->near != near) w->engine->run.needs_lists = 1;
    links->near = near;
    if (law->states != links->states) { /* other arrays: dem_add_link allocates them */
        dem__release(&w->def.allocator, links->block, links->bytes);
        links->block = NULL;
        links->capacity = 0;
        links->states = law->states;
    }
    dem__stop_link_work(w, others);
    dem__set_link_steps(w);
    dem__resume_link_work(w, others);
    return DEM_OK;
}

DEM_API dem_status dem_add_link(dem_world *world, ptrdiff_t i, ptrdiff_t j, int32_t element, const double *state) {
    dem_world *w = world;
    if (w && w->engine && w->engine->run.ending) return DEM_BUSY;
    if (!dem__is_present(w, i) || !w->engine->links.law || (!state && w->engine->links.states > 0) || i == j)
        return DEM_BAD_ARGUMENT;
    if (dem__shape_of(w, i) || (j >= 0 && j < w->count && dem__shape_of(w, j))) return DEM_POLYHEDRON;
    if (j >= 0 && j < w->count && dem__rigid_of(w, i) && dem__rigid_of(w, i) == dem__rigid_of(w, j))
        return DEM_BAD_ARGUMENT;
    if (j >= 0 ? !dem__is_present(w, j) : -1 - j >= w->walls) return DEM_BAD_ARGUMENT;
    if (w->engine->links.count + 1 > w->engine->links.capacity) {
        dem__array list[DEM__ARRAYS_MAX];
        if (w->engine->links.count > INT32_MAX / 2 ||
            !dem__grow_group(w, list, dem__link_arrays(w, list), &w->engine->links.block, &w->engine->links.bytes,
                             &w->engine->links.capacity, w->engine->links.count + 1))
            return DEM_OUT_OF_MEMORY;
    }
    const int32_t k = (int32_t)w->engine->links.count++;
    w->engine->links.i[k] = (int32_t)i, w->engine->links.j[k] = (int32_t)j, w->engine->links.element[k] = element;
    for (int a = 0; a < w->engine->links.states; a++) w->engine->links.state[a][k] = state[a];
    for (int a = 0; a < 9; a++) w->engine->links.wrench[a][k] = 0.0;
    w->engine->links.gap[k] = 0.0;
    w->engine->links.ended[k] = 0;
    dem__list_link(w, k);
    return DEM_OK;
}
