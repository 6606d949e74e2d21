/* Motion of rigid bodies, and the table of functions that the engine calls for them (dem__body_calls in base/engine.h).
   Reads the sums of forces on their particles; writes bodies and their particles. Promises: a sphere's motion is
   untouched; each body is moved by one thread, so bits do not depend on threads.

   To add a body of a new kind (a clump, a polyhedron), fill a dem__body_def and call dem__add_body. If a body has a
   single particle, that lies at the centre of mass; its radius is that of the sphere that the search for contacts uses.
   The forces on a body are those added to the sums of its particles, bodies.sum[i].load: force, and torque about the
   particle's centre. dem__rigid_of(w, i) returns the body of particle i. Its orientation at the end of the present step
   is in `turn`; during the search for contacts, in dem__pose_at(w, r, tau). */
#pragma once
#include "../step/detect.h"
#include "../step/integrate.h"

/* Returns whether a body rotates freely with three different moments. Such a rotation is integrated in rotation steps,
   of a quarter radian at most. */
DEM_INLINE int dem__rotates_in_steps(const dem__rigid *r) {
    return r->moments.x != r->moments.y && r->torque.x == 0.0 && r->torque.y == 0.0 && r->torque.z == 0.0;
}

#define DEM__ROTATION_STEPS_MAX 1e7 /* of a flight between two lists */
/* Returns the orientation of such a body at tau: whole rotation steps from the origin, then the rest. Starts from the
   rotation steps that are stored. */
static inline dem_quaternion dem__turn_of_flight(const dem__rigid *r, double tau) {
    const double rotation_step = dem__rotation_step(r->momentum, r->moments), whole = floor(tau / rotation_step);
    dem_quaternion q = r->turn;
    double n = 0.0;
    if (!(rotation_step < HUGE_VAL)) return q;
    if (r->rotation_steps > 0.0 && r->rotation_steps <= whole) n = r->rotation_steps, q = r->ahead;
    if (!(whole - n < DEM__ROTATION_STEPS_MAX)) return q; /* only in a world that no run has accepted */
    for (; n < whole; n += 1.0) q = dem__turn_nine(q, r->momentum, r->moments, rotation_step);
    return dem__turn_nine(q, r->momentum, r->moments, tau - whole * rotation_step);
}

/* Stores how far the rotations of flights are integrated, so that later calls need not start at their origins.
   DEM_TOO_FAST: a body turns by a hundred radians in a step. */
static inline void dem__keep_rotations(dem_world *w) {
    const dem__bodies *bodies = &w->engine->bodies;
    for (ptrdiff_t k = 0; k < bodies->rigid_count; k++) {
        dem__rigid *r = &bodies->rigid[k];
        if (!w->alive[r->first] || bodies->activity[r->first]) continue;
        const double rotation_step = dem__rotation_step(r->momentum, r->moments);
        const double whole = dem__rotates_in_steps(r) ? floor(dem__now(w, r->first) / rotation_step) : 0.0;
        if (!(400.0 * rotation_step > w->engine->run.dt) || !(whole - r->rotation_steps < DEM__ROTATION_STEPS_MAX)) {
            w->status = DEM_TOO_FAST;
            w->failed_id = w->id[r->first];
            return;
        }
        if (!(whole > r->rotation_steps)) continue;
        if (r->rotation_steps == 0.0) r->ahead = r->turn;
        for (; r->rotation_steps < whole; r->rotation_steps += 1.0)
            r->ahead = dem__turn_nine(r->ahead, r->momentum, r->moments, rotation_step);
    }
}

/* Returns the orientation of a rigid body, tau after its origin step [s]. */
DEM_INLINE dem_quaternion dem__turn_at(const dem_world *w, const dem__rigid *r, double tau) {
    const int single = tau <= 1.5 * w->engine->run.dt;
    if (tau == 0.0) return r->turn;
    if (!single && dem__rotates_in_steps(r)) return dem__turn_of_flight(r, tau);
    return dem__turn_free(r->turn, dem__plus(r->momentum, 0.5 * tau, r->torque), r->moments, tau, single);
}

static inline dem_quaternion dem__find_turn(const dem_world *w, const dem__rigid *r, double tau) {
    return dem__turn_at(w, r, tau);
}

/* Returns the state of a rigid body, tau after its origin step [s]. */
static inline dem__pose dem__find_pose(const dem_world *w, const dem__rigid *r, double tau) {
    dem__pose p;
    p.x = dem__body_at(r, tau), p.v = dem__plus(r->v, tau, r->a);
    p.momentum = dem__plus(r->momentum, tau, r->torque);
    p.turn = dem__turn_at(w, r, tau);
    p.spin = dem__spin_of(p.turn, r->moments, p.momentum);
    return p;
}

/* Places the particles of a body from its state at the origin step, with their velocity, spin and acceleration as parts
   of it. */
static inline void dem__place_pieces(dem_world *w, dem__rigid *r) {
    dem__bodies *bodies = &w->engine->bodies;
    const dem__axes axes = dem__axes_of(r->turn);
    r->rotation_steps = 0.0;
    const dem_vec spin = dem__spin_of(r->turn, r->moments, r->momentum);
    const dem_vec rate = dem__spin_of(r->turn, r->moments, dem__sub(r->torque, dem__cross(spin, r->momentum)));
    for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++) {
        const dem_vec arm = dem__out_of(&axes, bodies->offset[i]), round = dem__cross(spin, arm);
        dem_particle *p = &w->particle[i];
        bodies->arm[i] = arm;
        p->x = dem__in_box(w, dem__add(r->x, arm)), p->v = dem__add(r->v, round), p->spin = spin;
        p->a = dem__add(r->a, dem__add(dem__cross(rate, arm), dem__cross(spin, round)));
        w->spin_rate[i] = rate;
    }
}

/* Makes the present step the origin of a body. */
static inline void dem__set_body_origin(dem_world *w, dem__rigid *r) {
    const dem__pose p = dem__find_pose(w, r, dem__now(w, r->first));
    r->x = p.x, r->v = p.v, r->momentum = p.momentum, r->turn = p.turn;
    for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++) w->particle[i].origin = w->step;
    dem__place_pieces(w, r);
}

/* Sets the velocity and the spin of a body at its origin. */
static inline void dem__set_body_motion(dem_world *w, dem__rigid *r, dem_vec velocity, dem_vec spin) {
    r->v = velocity, r->momentum = dem__momentum_of(r->turn, r->moments, spin);
    dem__place_pieces(w, r);
}

/* Moves a body to the end of a step of length h that ends at tau after its origin, and its velocities to the middle.
   The velocities of its particles, which kernels read, follow from the mean of the arms at both ends. */
DEM_INLINE void dem__advance_body(dem_world *w, dem__rigid *r, double tau, double h) {
    dem__bodies *bodies = &w->engine->bodies;
    const double middle = tau - 0.5 * h;
    const int steps = tau <= h; /* otherwise its flight ends in this step */
    const dem_quaternion end = h > 0.0 && r->rotation_steps < 0.0 ? r->ahead : dem__turn_at(w, r, tau);
    const dem_quaternion from = steps || h == 0.0 ? r->turn : dem__turn_at(w, r, tau - h);
    const dem__axes axes = dem__axes_of(end);
    const dem_vec momentum = dem__plus(r->momentum, middle, r->torque);
    dem_vec spin = dem__spin_of(end, r->moments, momentum);
    if (h > 0.0) spin = dem__scale(0.5, dem__add(spin, dem__spin_of(from, r->moments, momentum)));
    r->x = dem__plus(r->x, tau, dem__plus(r->v, 0.5 * tau, r->a)), r->v = dem__plus(r->v, middle, r->a),
    r->momentum = momentum;
    r->turn = dem__kept_unit(end);
    r->rotation_steps = 0.0;
    if (w->engine->run.has_periodic) dem__put_in_box(w, r->first, &r->x);
    for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++) {
        const dem_vec arm = dem__out_of(&axes, bodies->offset[i]);
        const dem_vec old = h == 0.0 ? arm : steps ? bodies->arm[i] : dem__to_lab(from, bodies->offset[i]);
        dem_particle *p = &w->particle[i];
        bodies->arm[i] = arm;
        p->origin = w->step;
        p->x = dem__in_box(w, dem__add(r->x, arm)), p->spin = spin;
        p->v = dem__add(r->v, dem__cross(spin, dem__scale(0.5, dem__add(old, arm))));
    }
}

/* Sums the force on a body's particles and the torque about its centre: by contacts, by loads, or both. */
DEM_INLINE void dem__sum_on_body(const dem_world *w, const dem__rigid *r, int contacts, int loads, dem_vec *force,
                                 dem_vec *torque) {
    const dem__bodies *bodies = &w->engine->bodies;
    *force = *torque = dem_vec3(0.0, 0.0, 0.0);
    for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++) {
        for (int k = 0; k < 2; k++) {
            if (!(k ? loads : contacts)) continue;
            const double *six = k ? bodies->load[i] : bodies->sum[i].load;
            *force = dem__add(*force, dem__first(six));
            *torque = dem__add(*torque, dem__add(dem__second(six), dem__cross(bodies->arm[i], dem__first(six))));
        }
    }
}

/* Sets the sums from which dem__kick_all computes the accelerations of a body's particle. load: on the particle, or
   NULL. */
DEM_INLINE void dem__prepare_sum(dem__sum *sum, dem_vec pull, dem_vec rate, const double *load) {
    const double mass = 1.0 / sum->per_mass, inertia = 1.0 / sum->per_inertia;
    const dem_vec force = dem__scale(mass, pull), torque = dem__scale(inertia, rate);
    sum->load[0] = force.x, sum->load[1] = force.y, sum->load[2] = force.z;
    sum->load[3] = torque.x, sum->load[4] = torque.y, sum->load[5] = torque.z;
    for (int a = 0; load && a < 6; a++) sum->load[a] -= load[a];
}

/* Computes the acceleration of a body, and moves its velocities from the middle of a step to its end. Prepares its
   particles for dem__kick_all: sums that give them their accelerations as parts of the body, and velocities that it
   moves to those at the end. */
DEM_INLINE void dem__kick_body(dem_world *w, dem__rigid *r, double half) {
    dem__bodies *bodies = &w->engine->bodies;
    const int loads = bodies->adds_loads;
    dem_vec force;
    if (dem__is_fixed(w, r->first)) return; /* dem__kick_all records the forces on its particles */
    r->rotation_steps = 0.0;
    dem__sum_on_body(w, r, 1, loads, &force, &r->torque);
    if (w->engine->field.on) force = dem__add(force, w->engine->field.force[r->first]);
    const dem_vec pulled = dem__scale(1.0 / r->mass, force);
    r->a = dem__add(dem__free_fall(w), pulled);
    r->v = dem__flushed_vec(dem__plus(r->v, half, r->a));
    r->momentum = dem__flushed_vec(dem__plus(r->momentum, half, r->torque));
    const dem_vec spin = dem__spin_of(r->turn, r->moments, r->momentum);
    const dem_vec rate = dem__spin_of(r->turn, r->moments, dem__sub(r->torque, dem__cross(spin, r->momentum)));
    for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++) {
        const dem_vec arm = bodies->arm[i], round = dem__cross(spin, arm);
        const dem_vec pull = dem__add(dem__add(dem__cross(rate, arm), dem__cross(spin, round)), pulled);
        dem_particle *p = &w->particle[i];
        p->v = dem__plus(dem__add(r->v, round), -half, dem__add(dem__free_fall(w), pull));
        p->spin = dem__plus(spin, -half, rate);
        dem__prepare_sum(&bodies->sum[i], pull, rate, loads ? bodies->load[i] : NULL);
    }
}

/* Computes the acceleration of a body that touches nothing. */
static inline void dem__free_body(dem_world *w, dem__rigid *r) {
    dem_vec force;
    dem__sum_on_body(w, r, 0, 1, &force, &r->torque);
    if (w->engine->field.on) force = dem__add(force, w->engine->field.force[r->first]); /* 0 in flight */
    r->a = dem__plus(dem__free_fall(w), 1.0 / r->mass, force);
    if (dem__is_fixed(w, r->first)) r->a = r->torque = dem_vec3(0.0, 0.0, 0.0);
    dem__place_pieces(w, r);
}

/* Applies an impulse [N s] and an angular impulse [N m s] at particle i of a body, and a shift [kg m] along n. */
static inline void dem__push_body(dem_world *w, dem__rigid *r, ptrdiff_t i, dem_vec impulse, dem_vec turn, double shift,
                                  dem_vec n) {
    dem__bodies *bodies = &w->engine->bodies;
    const dem_vec arm = bodies->arm[i], moved = dem__scale(shift, n);
    r->v = dem__plus(r->v, 1.0 / r->mass, impulse);
    r->momentum = dem__add(r->momentum, dem__add(turn, dem__cross(arm, impulse)));
    if (shift == 0.0) return;
    const dem_vec angle = dem__spin_of(r->turn, r->moments, dem__cross(arm, moved));
    r->x = dem__plus(r->x, 1.0 / r->mass, moved);
    r->turn = dem__kept_unit(dem__turns(dem__turn_by(dem__scale(0.5, angle)), r->turn));
    for (ptrdiff_t k = r->first; k < r->first + r->pieces; k++)
        bodies->shifted[k] += fabs(shift) / r->mass + dem__length(angle) * dem__length(bodies->offset[k]);
}

/* Returns the greatest speed in flight of a point that is an arm [m] away from a body's centre, relative to it
   [m/s]. */
static inline double dem__turning_speed(const dem__rigid *r, double arm) {
    const dem_vec spin = dem__spin_of(r->turn, r->moments, r->momentum);
    const double i_min = r->moments.x < r->moments.z ? r->moments.x : r->moments.z,
                 least = i_min < r->moments.y ? i_min : r->moments.y;
    if (r->moments.x == r->moments.y) return (1.0 + 1e-9) * arm * dem__length(spin);
    /* with all of the rotational energy about the axis of least inertia */
    return (1.0 + 1e-6) * arm * sqrt(dem__dot(spin, r->momentum) / least);
}

/* Moves the bodies whose first particles are among the active ones first .. end-1. */
DEM_INLINE void dem__advance_some_bodies(dem_world *w, double h, ptrdiff_t first, ptrdiff_t end) {
    const int64_t step = w->step + (h > 0.0);
    for (ptrdiff_t k = first; k < end; k++) {
        const int32_t i = w->engine->bodies.active[k];
        dem__rigid *r = dem__rigid_of(w, i);
        if (r && r->first == i) dem__advance_body(w, r, (double)(step - w->particle[i].origin) * w->engine->run.dt, h);
    }
}
DEM__AVX2_CLONE(dem__advance_bodies, (dem_world * w, double h, ptrdiff_t first, ptrdiff_t end), (w, h, first, end),
                dem__advance_some_bodies(w, h, first, end))
/* Moves the velocities of these bodies to the end of the step. */
DEM_INLINE void dem__kick_some_bodies(dem_world *w, double half, ptrdiff_t first, ptrdiff_t end) {
    for (ptrdiff_t k = first; k < end; k++) {
        const int32_t i = w->engine->bodies.active[k];
        dem__rigid *r = dem__rigid_of(w, i);
        if (r && r->first == i) dem__kick_body(w, r, half);
    }
}
DEM__AVX2_CLONE(dem__kick_bodies, (dem_world * w, double half, ptrdiff_t first, ptrdiff_t end), (w, half, first, end),
                dem__kick_some_bodies(w, half, first, end))
static inline void dem__kick_bodies_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *h) {
    (void)part;
    dem__kick_bodies(w, 0.5 * *(const double *)h, first, end);
}
static inline void dem__kick_active_bodies(dem_world *w, double h) {
    const ptrdiff_t n = w->engine->bodies.active_count;
    dem__in_parts(w, dem__parts(w, n / 2), n, dem__kick_bodies_range, &h);
}

/* Computes the accelerations of all loaded bodies without contacts in the same way as dem__check_bounds. dem__kick_all
   computes them from sums over particles, which round differently. Which bodies are checked depends on what a step
   skips, and results must not depend on that. */
static inline void dem__place_loaded_bodies(dem_world *w) {
    const dem__bodies *bodies = &w->engine->bodies;
    for (ptrdiff_t k = 0; k < bodies->active_count && bodies->loads_on; k++) {
        const ptrdiff_t i = bodies->active[k];
        dem__rigid *r = dem__rigid_of(w, i);
        if (!r || r->first != i || w->touching[i] > 0) continue;
        dem__place_pieces(w, r); /* sets the arms that the torque needs */
        dem__free_body(w, r);
    }
}

/* Moves active particles first .. end-1 and the bodies whose first particles are among them to the end of the step. */
static inline void dem__advance_with_bodies(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *h) {
    const int32_t *active = w->engine->bodies.active;
    const dem__box b = dem__periodic_box(w);
    (void)part;
    for (ptrdiff_t k = first; k < end; k++) {
        if (!dem__rigid_of(w, active[k])) dem__advance_sphere(w, active[k], *(const double *)h, &b, 1);
    }
    dem__advance_bodies(w, *(const double *)h, first, end);
}

/* Tests the due pairs in pages first .. end-1. */
static inline void dem__test_due_with_bodies(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *step) {
    dem__test_due_part(w, &dem__work_of(w, part)->batch, first, end, *(const int64_t *)step, 1);
}

/* Applies an impulse, an angular impulse and a shift along n to particle i or to its rigid body. */
static inline void dem__push_any(dem_world *w, ptrdiff_t i, dem_vec impulse, dem_vec turn, double shift, dem_vec n) {
    dem__rigid *r = dem__rigid_of(w, i);
    dem_particle *p = &w->particle[i];
    if (dem__strike_fixed(w, i, impulse, turn)) return;
    dem__mark_to_check(w, i);
    if (r) {
        dem__push_body(w, r, i, impulse, turn, shift, n);
        dem__place_pieces(w, r);
        return;
    }
    p->v = dem__plus(p->v, 1.0 / p->mass, impulse);
    p->x = dem__plus(p->x, shift / p->mass, n);
    w->engine->bodies.shifted[i] += fabs(shift / p->mass);
    p->spin = dem__plus(p->spin, 1.0 / dem__inertia(w, i), turn);
}

/* Applies the impulses of a correction in which a rigid body takes part. */
static DEM__NOINLINE void dem__push_bodies(dem_world *w, int32_t c, int has_friction) {
    const dem__contacts *contacts = &w->engine->contacts;
    const dem__correction *h = &contacts->correction[c];
    const int32_t i = contacts->i[c], j = contacts->j[c];
    const dem_vec none = dem_vec3(0.0, 0.0, 0.0), n = dem_vec3(h->n[0], h->n[1], h->n[2]),
                  impulse = dem__first(h->impulse);
    const dem_vec on_i = has_friction ? dem__second(h->impulse) : none,
                  on_j = has_friction ? dem__first(h->impulse + 6) : none;
    dem__push_any(w, i, impulse, on_i, 0.0, n);
    if (j >= 0) dem__push_any(w, j, dem__scale(-1.0, impulse), on_j, 0.0, n);
    else dem__strike_wall(&w->wall[-1 - j], w->particle[i].x, n, dem__scale(-1.0, impulse), dem__scale(-1.0, on_i));
}

/* Applies the shift of a correction in which a rigid body takes part. A shift changes the angular momentum of the
   centres of mass about the common centre. Two opposite impulses at the particles restore it. */
static DEM__NOINLINE void dem__shift_bodies(dem_world *w, int32_t c) {
    const dem__contacts *contacts = &w->engine->contacts;
    const dem__correction *h = &contacts->correction[c];
    const int32_t i = contacts->i[c], j = contacts->j[c];
    const dem_vec none = dem_vec3(0.0, 0.0, 0.0), n = dem_vec3(h->n[0], h->n[1], h->n[2]);
    if (j < 0) {
        dem__push_any(w, i, none, none, h->shift, n);
        const dem_vec v = dem__sub(w->particle[i].v, dem__surface_velocity(&w->wall[-1 - j], w->particle[i].x, n));
        dem__expect_impact(w, i, j, n, -dem__dot(v, n));
        return;
    }
    const dem_vec d = dem__nearest_image(w, dem__sub(w->particle[i].x, w->particle[j].x));
    const dem_vec u = dem__sub(dem__centre_velocity(w, i), dem__centre_velocity(w, j));
    const double distance = dem__length(d) + h->shift * (dem__per_mass(w, i) + dem__per_mass(w, j));
    const dem_vec slower = dem__scale(-h->shift / distance, dem__sub(u, dem__scale(dem__dot(u, n), n)));
    dem__push_any(w, i, slower, none, 0.0, n), dem__push_any(w, j, dem__scale(-1.0, slower), none, 0.0, n);
    dem__push_any(w, i, none, none, h->shift, n), dem__push_any(w, j, none, none, -h->shift, n);
    dem__expect_impact(w, i, j, n, -dem__dot(dem__sub(w->particle[i].v, w->particle[j].v), n));
}

/* Applies all such shifts, after all impulses, which act where forces were found. */
static inline void dem__shift_corrected(dem_world *w) {
    const dem__contacts *contacts = &w->engine->contacts;
    for (const dem__chunk *in = contacts->chunk; in < contacts->chunk + contacts->chunk_count; in++) {
        for (ptrdiff_t k = 0; k < in->marked; k++) {
            const int32_t c = contacts->slots[in->first + k];
            if (contacts->partial[c] && dem__has_body(w, contacts->i[c], contacts->j[c])) dem__shift_bodies(w, c);
        }
    }
}

static inline const dem__body_calls *dem__rigid_bodies(void) {
    static const dem__body_calls row = {
        dem__find_pose,    dem__find_turn,    dem__set_body_origin,      dem__set_body_motion,
        dem__place_pieces, dem__free_body,    dem__test_due_with_bodies, dem__advance_with_bodies,
        dem__push_bodies,  dem__turning_speed};
    return &row;
}

/* Makes room for n more bodies, not for their particles. Returns 0 when out of memory. */
static inline int dem__grow_bodies(dem_world *w, ptrdiff_t n) {
    dem__bodies *bodies = &w->engine->bodies;
    const dem_allocator *a = &w->def.allocator;
    const ptrdiff_t old = bodies->rigid_capacity, wanted = bodies->rigid_count + n, larger = wanted + wanted / 2 + 16;
    if (wanted <= old) return 1;
    dem__rigid *fresh =
        (dem__rigid *)a->fn(a->user, bodies->rigid, (size_t)old * sizeof *fresh, (size_t)larger * sizeof *fresh);
    if (!fresh) return 0;
    bodies->rigid = fresh, bodies->rigid_capacity = larger, bodies->calls = dem__rigid_bodies();
    return 1;
}

/* Sorts moments as the exact rotation needs: the two that differ least come first, and become equal if they differ only
   by rounding. Turns the frame accordingly. order: the old axis of each new one. */
static inline void dem__order_moments(dem_vec *moments, dem_quaternion *frame, int *order) {
    const double m[3] = {moments->x, moments->y, moments->z};
    int third = 2;
    for (int k = 0; k < 2; k++) { /* the axis whose two others differ least */
        if (fabs(m[(k + 1) % 3] - m[(k + 2) % 3]) < fabs(m[(third + 1) % 3] - m[(third + 2) % 3])) third = k;
    }
    for (int k = 0; k < 3; k++)
        order[k] = (third + 1 + k) % 3; /* a cyclic exchange of axes is a rotation about (1, 1, 1) */
    const double turns = (double)((third + 1) % 3);
    if (turns > 0.0) {
        const double c = 0.5, s = (turns == 1.0 ? 0.5 : -0.5);
        *frame = dem__turns(*frame, dem__quaternion(c, dem_vec3(s, s, s)));
    }
    moments->x = m[order[0]], moments->y = m[order[1]], moments->z = m[order[2]];
    if (fabs(moments->x - moments->y) <= 1e-12 * moments->x) moments->y = moments->x;
    if (fabs(moments->x - moments->z) <= 1e-12 * moments->x && moments->x == moments->y) moments->z = moments->x;
}
