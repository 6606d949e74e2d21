/* -------------------------------------------------------------------------------------------- >>flight */
/* Where particles are at a time after their origin step: a sphere on a parabola, a particle of a rigid body turned about one. Reads
   bodies. Promises: the same bits whenever a state is evaluated.
   May be changed here alone: how a state is evaluated, bit for bit the same.

   A rigid body (dem__rigid) has the orientation, mass and moments. The particles that touch for it (dem_particle) are consecutive in the
   world's arrays. Their mass is the body's, and their contacts count for all of them; x, v, a and spin are those of their centres as parts
   of the body, valid at the origin step and while forces are computed. In flight use dem__at and its like, never the parabola. */
/* Returns the acceleration of a particle in flight without loads [m/s2]. Bounds and the list rely on its being the same for all. */
DEM_INLINE dem_vec dem__free_fall(const dem_world *w) { return w->def.gravity; }

/* Returns the time since the origin step of particle i [s]. */
DEM_INLINE double dem__now(const dem_world *w, ptrdiff_t i) { return (double)(w->step - w->particle[i].origin) * w->engine->run.dt; }

DEM_INLINE double dem__wrapped(double v, double low, double high) {
    if (v >= low && v < high) return v;
    const double length = high - low, x = v - length * floor((v - low) / length);
    return x < low ? low : x > high ? high : x; /* rounding, very far away */
}
DEM_INLINE dem_vec dem__in_box(const dem_world *w, dem_vec x) {
    const dem_def *d = &w->def;
    if (d->periodic[0]) x.x = dem__wrapped(x.x, d->low.x, d->high.x);
    if (d->periodic[1]) x.y = dem__wrapped(x.y, d->low.y, d->high.y);
    if (d->periodic[2]) x.z = dem__wrapped(x.z, d->low.z, d->high.z);
    return x;
}

/* Returns the rigid body of particle i, or NULL. */
DEM_INLINE dem__rigid *dem__rigid_of(const dem_world *w, ptrdiff_t i) {
    const dem__bodies *bodies = &w->engine->bodies;
    return bodies->rigid && bodies->rigid_of[i] > 0 ? &bodies->rigid[bodies->rigid_of[i] - 1] : NULL;
}

/* State of a rigid body at tau after its origin step. */
typedef struct dem__posture {
    dem_vec x, v, spin, momentum;
    dem_quaternion turn;
} dem__posture;
/* Returns whether a body rotates freely with three moments: such a rotation is integrated in strides, of a quarter radian at most. */
DEM_INLINE int dem__strides(const dem__rigid *r) {
    return r->moments.x != r->moments.y && r->torque.x == 0.0 && r->torque.y == 0.0 && r->torque.z == 0.0;
}

/* Returns the orientation of such a body at tau: whole strides from the origin, then the rest. Begins with the strides that are known. */
static inline dem_quaternion dem__turn_of_flight(const dem__rigid *r, double tau) {
    const double stride = dem__turn_stride(r->momentum, r->moments), whole = floor(tau / stride);
    dem_quaternion q = r->turn;
    double n = 0.0;
    if (!(stride < HUGE_VAL)) return q;
    if (r->strides > 0.0 && r->strides <= whole) n = r->strides, q = r->ahead;
    for (; n < whole; n += 1.0) q = dem__turn_nine(q, r->momentum, r->moments, stride);
    return dem__turn_nine(q, r->momentum, r->moments, tau - whole * stride);
}

/* Stores how far the rotations of flights are integrated, so that later calls need not begin at their origins. */
static inline void dem__note_strides(dem_world *w) {
    const dem__bodies *bodies = &w->engine->bodies;
    for (ptrdiff_t k = 0; k < bodies->rigid_count; k++) {
        dem__rigid *r = &bodies->rigid[k];
        if (!w->alive[r->first] || !dem__strides(r) || bodies->activity[r->first]) continue;
        const double stride = dem__turn_stride(r->momentum, r->moments), whole = floor(dem__now(w, r->first) / stride);
        if (!(whole > r->strides)) continue;
        if (r->strides == 0.0) r->ahead = r->turn;
        for (; r->strides < whole; r->strides += 1.0) r->ahead = dem__turn_nine(r->ahead, r->momentum, r->moments, stride);
    }
}

/* Returns the state of a rigid body at tau after its origin step [s]. */
static inline dem__posture dem__posture_at(const dem_world *w, const dem__rigid *r, double tau) {
    dem__posture p;
    p.x = dem__plus(r->x, tau, dem__plus(r->v, 0.5 * tau, r->a)), p.v = dem__plus(r->v, tau, r->a);
    p.momentum = dem__plus(r->momentum, tau, r->torque);
    if (tau == 0.0) p.turn = r->turn;
    else if (tau > 1.5 * w->engine->run.dt && dem__strides(r)) p.turn = dem__turn_of_flight(r, tau);
    else p.turn = dem__turn_free(r->turn, dem__plus(r->momentum, 0.5 * tau, r->torque), r->moments, tau, tau <= 1.5 * w->engine->run.dt);
    p.spin = dem__spin_of(p.turn, r->moments, p.momentum);
    return p;
}
static DEM__NOINLINE dem_vec dem__piece_at(const dem_world *w, const dem__rigid *r, ptrdiff_t i, double tau) {
    const dem__posture p = dem__posture_at(w, r, tau);
    return dem__add(p.x, dem__to_lab(p.turn, w->engine->bodies.offset[i]));
}
static DEM__NOINLINE dem_vec dem__piece_velocity_at(const dem_world *w, const dem__rigid *r, ptrdiff_t i, double tau) {
    const dem__posture p = dem__posture_at(w, r, tau);
    return dem__add(p.v, dem__cross(p.spin, dem__to_lab(p.turn, w->engine->bodies.offset[i])));
}

/* Returns the position of a sphere at tau after its origin step [s], on its parabola. */
DEM_INLINE dem_vec dem__sphere_at(const dem_world *w, ptrdiff_t i, double tau) {
    const dem_particle *p = &w->particle[i];
    return dem__plus(p->x, tau, dem__plus(p->v, 0.5 * tau, p->a));
}
DEM_INLINE dem_vec dem__sphere_velocity_at(const dem_world *w, ptrdiff_t i, double tau) {
    return dem__plus(w->particle[i].v, tau, w->particle[i].a);
}
DEM_INLINE dem_vec dem__sphere_spin_at(const dem_world *w, ptrdiff_t i, double tau) {
    return dem__plus(w->particle[i].spin, tau, w->spin_rate[i]);
}

/* Returns the position of any particle at tau after its origin step. */
DEM_INLINE dem_vec dem__at(const dem_world *w, ptrdiff_t i, double tau) {
    const dem__rigid *r = dem__rigid_of(w, i);
    return r ? dem__piece_at(w, r, i, tau) : dem__sphere_at(w, i, tau);
}
DEM_INLINE dem_vec dem__velocity_at(const dem_world *w, ptrdiff_t i, double tau) {
    const dem__rigid *r = dem__rigid_of(w, i);
    return r ? dem__piece_velocity_at(w, r, i, tau) : dem__sphere_velocity_at(w, i, tau);
}
/* Returns the velocity as accurately as it is known. In a force field, the parabola of a flight has the right places at both ends, but not
   the right velocities; the error at its end shows how the acceleration changes. */
static inline dem_vec dem__true_velocity_at(const dem_world *w, ptrdiff_t i, double tau) {
    const dem__field *field = &w->engine->field;
    const dem_vec v = dem__velocity_at(w, i, tau);
    if (!field->on || w->engine->bodies.activity[i] || field->until[i] == DEM__NO_FLIGHT) return v;
    const double whole = (double)(field->until[i] - w->particle[i].origin) * w->engine->run.dt, share = tau / whole;
    if (!(share >= 0.0 && share <= 1.0)) return v;
    return dem__plus(v, share * (3.0 * share - 2.0), dem__sub(field->end_velocity[i], dem__velocity_at(w, i, whole)));
}
DEM_INLINE dem_vec dem__spin_at(const dem_world *w, ptrdiff_t i, double tau) {
    const dem__rigid *r = dem__rigid_of(w, i);
    return r ? dem__posture_at(w, r, tau).spin : dem__sphere_spin_at(w, i, tau);
}
