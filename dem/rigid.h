/* --------------------------------------------------------------------------------------------- >>rigid */
/* Motion of rigid bodies: kick of momentum and angular momentum, free drift, kick. Reads the sums of forces on their particles; writes
   bodies and their particles. Promises: a sphere's motion is untouched; each body is moved by one thread, so that bits do not depend on
   threads.
   May be changed here alone: how a body is integrated.

   To add a body of a new kind (a clump, a polyhedron), fill a dem__body_def and call dem__add_body. The only particle of a body that has
   one lies at its centre of mass; its radius is that of the sphere that the search for contacts uses. The forces on a body are those added
   to the sums of its particles, bodies.sum[i].load: force, and torque about the particle's centre. dem__rigid_of(w, i) returns the body of
   particle i. Its orientation at the end of the present step is in `turn`; in the search for contacts, in dem__posture_at(w, r, tau). */
/* Places the particles of a body by its state at the origin step, with velocity, spin and acceleration as parts of it. */
static inline void dem__place_pieces(dem_world *w, dem__rigid *r) {
    dem__bodies *bodies = &w->engine->bodies;
    r->strides = 0.0;
    const dem_vec spin = dem__spin_of(r->turn, r->moments, r->momentum);
    const dem_vec rate = dem__spin_of(r->turn, r->moments, dem__sub(r->torque, dem__cross(spin, r->momentum)));
    for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++) {
        const dem_vec arm = dem__to_lab(r->turn, bodies->offset[i]), round = dem__cross(spin, arm);
        dem_particle *p = &w->particle[i];
        bodies->arm[i] = arm;
        p->x = dem__in_box(w, dem__add(r->x, arm)), p->v = dem__add(r->v, round), p->spin = spin;
        p->a = dem__add(r->a, dem__add(dem__cross(rate, arm), dem__cross(spin, round)));
        w->spin_rate[i] = rate;
    }
}

/* Makes the present step the origin of a body. */
static inline void dem__set_body_origin(dem_world *w, dem__rigid *r) {
    const dem__posture p = dem__posture_at(w, r, dem__now(w, r->first));
    r->x = p.x, r->v = p.v, r->momentum = p.momentum, r->turn = p.turn;
    for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++) w->particle[i].origin = w->step;
    dem__place_pieces(w, r);
}

/* Puts a body back into the periodic box. Where gravity has a component along the box, it gains potential energy, which is booked. */
static inline void dem__wrap_body(dem_world *w, dem__rigid *r) {
    const dem_vec x = dem__in_box(w, r->x);
    if (w->engine->ledger.on) dem__book_wrap(w, -r->mass * dem__dot(dem__free_fall(w), dem__sub(x, r->x)));
    r->x = x;
}

/* Moves a body to the end of a step of length h that ends at tau after its origin, and its velocities to the middle. Those of its
   particles, which kernels read, are computed with the mean of the arms at both ends. */
static inline void dem__advance_body(dem_world *w, dem__rigid *r, double tau, double h) {
    dem__bodies *bodies = &w->engine->bodies;
    const double middle = tau - 0.5 * h;
    const int steps = tau <= h; /* else its flight ends in this step */
    const dem__posture end = dem__posture_at(w, r, tau);
    const dem_quaternion from = steps || h == 0.0 ? r->turn : dem__posture_at(w, r, tau - h).turn;
    const dem_vec momentum = dem__plus(r->momentum, middle, r->torque);
    dem_vec spin = dem__spin_of(end.turn, r->moments, momentum);
    if (h > 0.0) spin = dem__scale(0.5, dem__add(spin, dem__spin_of(from, r->moments, momentum)));
    r->v = dem__plus(r->v, middle, r->a), r->x = end.x, r->momentum = momentum;
    r->turn = dem__kept_unit(end.turn);
    if (w->engine->run.has_periodic) dem__wrap_body(w, r);
    for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++) {
        const dem_vec arm = dem__to_lab(end.turn, bodies->offset[i]);
        const dem_vec before = h == 0.0 ? arm : steps ? bodies->arm[i] : dem__to_lab(from, bodies->offset[i]);
        dem_particle *p = &w->particle[i];
        bodies->arm[i] = arm;
        p->x = dem__in_box(w, dem__add(r->x, arm)), p->spin = spin;
        p->v = dem__add(r->v, dem__cross(spin, dem__scale(0.5, dem__add(before, arm))));
    }
}

/* Sums the force and the torque about its centre that act on a body's particles: by contacts, by loads, or both. */
static inline void dem__sum_on_body(const dem_world *w, const dem__rigid *r, int contacts, int loads, dem_vec *force, dem_vec *torque) {
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

/* Computes the acceleration of a body, and moves its velocities from the middle of a step to its end. Prepares its particles for
   dem__kick_all: sums that give them their accelerations as parts of the body, and velocities that it moves to those at the end. */
static inline void dem__kick_body(dem_world *w, dem__rigid *r, double half) {
    dem__bodies *bodies = &w->engine->bodies;
    const int loads = bodies->loads_on || w->engine->links.on;
    dem_vec force;
    r->strides = 0.0;
    dem__sum_on_body(w, r, 1, loads, &force, &r->torque);
    r->a = dem__plus(dem__free_fall(w), 1.0 / r->mass, force);
    r->v = dem__flushed_vec(dem__plus(r->v, half, r->a));
    r->momentum = dem__flushed_vec(dem__plus(r->momentum, half, r->torque));
    const dem_vec spin = dem__spin_of(r->turn, r->moments, r->momentum);
    const dem_vec rate = dem__spin_of(r->turn, r->moments, dem__sub(r->torque, dem__cross(spin, r->momentum)));
    for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++) {
        const dem_vec arm = bodies->arm[i], round = dem__cross(spin, arm);
        const dem_vec pull = dem__plus(dem__add(dem__cross(rate, arm), dem__cross(spin, round)), 1.0 / r->mass, force);
        dem__sum *sum = &bodies->sum[i];
        dem_particle *p = &w->particle[i];
        p->v = dem__plus(dem__add(r->v, round), -half, dem__add(dem__free_fall(w), pull));
        p->spin = dem__plus(spin, -half, rate);
        for (int a = 0; a < 3; a++) {
            sum->load[a] = dem_axis(pull, a) / sum->per_mass - (loads ? bodies->load[i][a] : 0.0);
            sum->load[3 + a] = dem_axis(rate, a) / sum->per_inertia - (loads ? bodies->load[i][3 + a] : 0.0);
        }
    }
}

/* Computes the acceleration of a body that touches nothing. */
static inline void dem__free_body(dem_world *w, dem__rigid *r) {
    dem_vec force;
    dem__sum_on_body(w, r, 0, 1, &force, &r->torque);
    r->a = dem__plus(dem__free_fall(w), 1.0 / r->mass, force);
    dem__place_pieces(w, r);
}

/* Applies an impulse [N s] and an angular impulse [N m s] at particle i of a body, and a shift [kg m] along n. */
static inline void dem__push_body(dem_world *w, dem__rigid *r, ptrdiff_t i, dem_vec impulse, dem_vec turn, double shift, dem_vec n) {
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

/* Returns the greatest speed of a particle relative to its body's centre, in flight [m/s]. */
static inline double dem__swing(const dem_world *w, const dem__rigid *r, ptrdiff_t i) {
    const dem_vec spin = dem__spin_of(r->turn, r->moments, r->momentum);
    const double arm = dem__length(w->engine->bodies.offset[i]), i_min = r->moments.x < r->moments.z ? r->moments.x : r->moments.z,
                 least = i_min < r->moments.y ? i_min : r->moments.y;
    if (r->moments.x == r->moments.y) return (1.0 + 1e-9) * arm * dem__length(spin);
    return (1.0 + 1e-6) * arm * sqrt(dem__dot(spin, r->momentum) / least); /* all of the rotational energy about the axis of least
                                                                              inertia */
}

/* Moves the bodies whose first particles are among the active ones first .. end-1. */
static inline void dem__advance_bodies_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const double h = *(const double *)context;
    const int64_t step = w->step + (h > 0.0);
    (void)part;
    for (ptrdiff_t k = first; k < end; k++) {
        const int32_t i = w->engine->bodies.active[k];
        dem__rigid *r = dem__rigid_of(w, i);
        if (r && r->first == i) dem__advance_body(w, r, (double)(step - w->particle[i].origin) * w->engine->run.dt, h);
    }
}
/* Moves their velocities to the end of the step. */
static inline void dem__kick_bodies_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const double half = 0.5 * *(const double *)context;
    (void)part;
    for (ptrdiff_t k = first; k < end; k++) {
        const int32_t i = w->engine->bodies.active[k];
        dem__rigid *r = dem__rigid_of(w, i);
        if (r && r->first == i) dem__kick_body(w, r, half);
    }
}
