/* Links: setting their law, adding one, and their own step. Reads bodies and the law of links; writes links, and the
   loads and velocities of bodies. dem_set_links adds the feature to a world. */
#pragma once
#include "../bodies/rigid.h"
#include "getters.h"
#include "kernel.h"
#include "list.h"
#include "save.h"

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

/* Returns whether particle i has links, or its load still contains forces of links. */
DEM_INLINE int dem__is_linked(const dem_world *w, ptrdiff_t i) {
    return w->engine->links.first_link[i] >= 0 || w->engine->links.is_loaded[i];
}

/* Applies half of the change of its links' forces to a body; the old forces are in the sums. In flight, the old torque
   belongs to the position where it was computed. For a body that takes steps, both torques are taken at the present
   position. */
static inline void dem__kick_linked_body(dem_world *w, dem__rigid *r, double half) {
    const dem__bodies *bodies = &w->engine->bodies;
    dem_vec force, torque, more = dem_vec3(0.0, 0.0, 0.0), turning = more;
    dem__sum_on_body(w, r, 0, 1, &force, &torque);
    if (w->touching[r->first] == 0) {
        more = dem__sub(dem__plus(dem__free_fall(w), 1.0 / r->mass, force), r->a),
        turning = dem__sub(torque, r->torque);
    } else {
        for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++) {
            if (!dem__is_linked(w, i)) continue;
            const dem_vec change = dem__sub(dem__first(bodies->load[i]), dem__first(bodies->sum[i].load));
            more = dem__plus(more, 1.0 / r->mass, change);
            turning =
                dem__add(turning, dem__add(dem__sub(dem__second(bodies->load[i]), dem__second(bodies->sum[i].load)),
                                           dem__cross(bodies->arm[i], change)));
        }
    }
    r->v = dem__flushed_vec(dem__plus(r->v, half, more)), r->a = dem__add(r->a, more);
    r->momentum = dem__flushed_vec(dem__plus(r->momentum, half, turning)), r->torque = dem__add(r->torque, turning);
    dem__place_pieces(w, r);
}

/* Estimates from the present forces how far links change the velocity of particle i of a rigid body until they are
   evaluated again [m/s]. */
static inline double dem__body_link_drift(const dem_world *w, const dem__rigid *r, ptrdiff_t i) {
    const dem_vec m = r->moments;
    const double least = m.x < m.y ? (m.x < m.z ? m.x : m.z) : m.y < m.z ? m.y : m.z;
    dem_vec force, torque;
    dem__sum_on_body(w, r, 0, 1, &force, &torque);
    return (double)w->engine->links.every * w->engine->run.dt *
           (dem__length(force) / r->mass + dem__length(torque) * dem__length(w->engine->bodies.offset[i]) / least);
}

/* Estimates from the present forces how far links change the velocity of particle i until they are evaluated again
   [m/s]. */
DEM_INLINE double dem__link_drift(const dem_world *w, ptrdiff_t i) {
    const dem__rigid *r = dem__rigid_of(w, i);
    if (r) return dem__body_link_drift(w, r, i);
    return (double)w->engine->links.every * w->engine->run.dt / w->particle[i].mass *
           dem__length(dem__first(w->engine->bodies.load[i]));
}

/* Returns the kinetic energy of a sphere whose origin is the present step [J]; 0 if it is fixed, and for a body, whose
   energy counts where it is kicked. */
DEM_INLINE double dem__energy_at_origin(const dem_world *w, ptrdiff_t i) {
    const dem_particle *p = &w->particle[i];
    if (!dem__is_free_sphere(w, i)) return 0.0;
    return 0.5 * p->mass * dem__dot(p->v, p->v) + 0.5 * dem__inertia(w, i) * dem__dot(p->spin, p->spin);
}

/* Makes the present step the origin of a linked particle, books the work of its links so far, and moves its load to the
   sums. */
static inline void dem__stop_linked(dem_world *w, ptrdiff_t i) {
    dem__bodies *bodies = &w->engine->bodies;
    dem__rigid *r = dem__rigid_of(w, i);
    dem__set_origin(w, i);
    dem__wrap(w, i);
    if (r) dem__place_pieces(w, r);
    if (w->engine->ledger.on) dem__book_link_work(w, dem__link_work(w, i) - dem__energy_at_origin(w, i));
    memcpy(bodies->sum[i].load, bodies->load[i], sizeof bodies->load[i]);
    memcpy(bodies->load[i], bodies->external[i], sizeof bodies->load[i]);
}

/* Applies half of the change of its links' forces to a particle; the old forces are in the sums. A body is kicked when
   its first linked particle is. */
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
        dem__kick_linked_body(w, r, half);
        dem__book_link_work(w, dem__motion_energy(w, r->first));
        return;
    }
    const dem_vec a = dem__scale(sum->per_mass, dem__sub(dem__first(load), dem__first(sum->load)));
    const dem_vec b = dem__scale(sum->per_inertia, dem__sub(dem__second(load), dem__second(sum->load)));
    p->v = dem__flushed_vec(dem__plus(p->v, half, a)), p->a = dem__add(p->a, a);
    p->spin = dem__flushed_vec(dem__plus(p->spin, half, b)), w->spin_rate[i] = dem__add(w->spin_rate[i], b);
    dem__book_link_work(w, dem__energy_at_origin(w, i));
}

/* Keeps the bound of a particle whose links have been evaluated if it holds until the next evaluation; otherwise sets a
   new one. */
static inline void dem__check_linked(dem_world *w, ptrdiff_t i) {
    const double deviation = dem__length(dem__deviation(w, i, dem__since_listed(w, w->step)));
    if (deviation < w->engine->bodies.bound[i].tolerance - dem__link_drift(w, i))
        dem__set_tolerance_left(w, i, deviation);
    else {
        const int32_t one = (int32_t)i;
        dem__renew_bound(w, i, w->step);
        dem__reset_pair_timers(w, &one, 1, w->step);
    }
}

/* Advances links by velocity Verlet with a step of their own. Their forces are constant between two evaluations. Each
   evaluation corrects the velocities to the mean of the old and the new force. */
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

static inline int dem__end_step_with_links(dem_world *w) {
    dem__links *links = &w->engine->links;
    if (links->every > 0 && w->step % links->every == 0) dem__step_links(w);
    return w->status == DEM_OK;
}

static inline int dem__list_arrays_of_links(dem_world *w, dem__array *list) {
    dem__links *links = &w->engine->links;
    const dem__array arrays[] = {{&links->first_link, sizeof *links->first_link},
                                 {&links->is_loaded, sizeof *links->is_loaded},
                                 {&links->evaluated_at, sizeof *links->evaluated_at}};
    memcpy(list, arrays, sizeof arrays);
    return (int)(sizeof arrays / sizeof *arrays);
}

static inline void dem__release_links(dem_world *w) {
    dem__release(&w->def.allocator, w->engine->links.block, w->engine->links.bytes);
}

static inline void dem__add_unlinked(dem_world *w, ptrdiff_t i) {
    w->engine->links.first_link[i] = -1;
    w->engine->links.is_loaded[i] = 0;
}

/* Ends the links of a particle that leaves, from the highest slot down, because the order of its list depends on the
   history. */
static inline void dem__cut_links_of(dem_world *w, ptrdiff_t i) {
    dem__book_link_work(w, dem__link_work(w, i));
    while (w->engine->links.first_link[i] >= 0) dem__cut_link(w, dem__last_link(w, i));
    w->engine->links.is_loaded[i] = 0; /* the work of its links has been booked */
}

static inline void dem__renumber_links(dem_world *w, const int32_t *number) {
    dem__links *links = &w->engine->links;
    for (ptrdiff_t k = 0; k < links->count; k++) {
        links->i[k] = number[links->i[k]];
        if (links->j[k] >= 0) links->j[k] = number[links->j[k]];
    }
}

/* Refuses a run with links that have no law: after loading, dem_set_links must come first. */
static inline dem_status dem__check_links(const dem_world *w, const dem_kernel *kernel) {
    (void)kernel;
    return w->engine->links.count > 0 && !w->engine->links.law ? DEM_LAW_MISMATCH : DEM_OK;
}

static inline void dem__begin_link_ledger(dem_world *w) { dem__resume_link_work(w, dem__all_particles(w)); }

/* Finds the links of each particle for a new list. Its skin must be far larger than the reach of links. */
static inline dem_status dem__relist_links(dem_world *w) {
    const dem__links *links = &w->engine->links;
    if (!(links->near <= 0.01 * w->engine->pairs.skin) && links->count > 0) return DEM_BAD_DEFINITION;
    dem__find_links(w);
    return DEM_OK;
}

static inline double dem__drift_by_links(const dem_world *w, ptrdiff_t i) {
    const int linked = w->engine->links.first_link[i] >= 0 || dem__rigid_of(w, i);
    return linked ? 2.0 * dem__link_drift(w, i) : 0.0;
}

static inline int dem__is_linked_with(const dem_world *w, ptrdiff_t i, ptrdiff_t j, int32_t element) {
    return dem__link_of(w, i, j, element) >= 0;
}

static inline void dem__open_link_ledger(const dem_world *w, ptrdiff_t i, dem_energy_ledger *sums) {
    sums->link_work += dem__link_work(w, i);
}

static inline dem__feature dem__feature_links(void) {
    dem__feature f = dem__new_feature(DEM__LINKS_FEATURE);
    f.adds_loads = 1;
    f.exclusive = 1;
    f.list_arrays = dem__list_arrays_of_links;
    f.release = dem__release_links;
    f.add_particle = dem__add_unlinked;
    f.begin_change = dem__stop_link_work;
    f.end_change = dem__resume_link_work;
    f.set_time_step = dem__set_link_steps;
    f.remove_particle = dem__cut_links_of;
    f.renumber = dem__renumber_links;
    f.check_run = dem__check_links;
    f.begin_ledger = dem__begin_link_ledger;
    f.listed = dem__relist_links;
    f.drift = dem__drift_by_links;
    f.begins_early = dem__is_linked_with;
    f.end_step = dem__end_step_with_links;
    f.forces = dem_link_count;
    f.force = dem_get_link;
    f.open_books = dem__open_link_ledger;
    f.world_fields = dem__world_fields_of_links;
    f.particle_fields = dem__particle_fields_of_links;
    f.save = dem__save_links;
    f.is_used = dem__has_links;
    f.load = dem__load_links;
    f.loaded = dem__derive_links;
    f.hash_particle = dem__hash_linked;
    f.hash_before_contacts = dem__hash_links;
    return f;
}

DEM_API dem_status dem_set_links(dem_world *world, const dem_link_kernel *kernel, double interval, double near) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (dem__lacks_memory(w)) return DEM_BAD_ARGUMENT;
    if (!kernel || !kernel->loop || !dem__is_law(kernel->law))
        return dem__refuse(
            w, "kernel: NULL, without a loop, or of a law without a force or with too many states or constants");
    if (!dem__positive(interval)) return dem__refuse(w, "interval: not a finite number above 0");
    if (!dem__not_negative(near)) return dem__refuse(w, "near: below 0 or not finite");
    dem__links *links = &w->engine->links;
    const dem_law *law = kernel->law;
    if (links->count > 0 && (law->states != links->states || !dem__is_of_law(links->mark, law)))
        return DEM_LAW_MISMATCH;
    if (!links->on) {
        const dem_status status = dem__take_feature(w, dem__feature_links());
        if (status != DEM_OK) return status;
        for (ptrdiff_t i = 0; i < w->count; i++) dem__add_unlinked(w, i);
    }
    dem__pieces others = dem__all_particles(w); /* from here on their work is counted with another interval */
    if (links->on && links->interval == interval) others.end = others.first; /* a loaded world gets its law again */
    links->on = 1;
    links->law = law, links->mark = dem__law_mark(law);
    links->loop = kernel->loop;
    links->interval = interval;
    if (links->near != near) w->engine->run.needs_lists = 1;
    links->near = w->engine->pairs.touch_gap = near;
    if (law->states != links->states) { /* other arrays, which dem_add_link allocates */
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
    if (dem__lacks_particle(w, i)) return DEM_BAD_ARGUMENT;
    if (!w->engine->links.law) return dem__refuse(w, "world: links have no law: call dem_set_links first");
    if (!state && w->engine->links.states > 0) return dem__refuse(w, "state: NULL, but the law has states");
    if (i == j) return dem__refuse(w, "j: the same particle as i");
    if (j >= 0 ? !dem__is_present(w, j) : -1 - j >= w->walls)
        return dem__refuse(w, "j: no particle of this index is present, or no wall -1 - j");
    if (dem__has_polyhedron(w, i, j)) return DEM_POLYHEDRON;
    if (j >= 0 && dem__pieces_of(w, i).first == dem__pieces_of(w, j).first)
        return dem__refuse(w, "j: a part of the same body as i");
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
