/* A force field. Particles in flight advance by steps of their own; for the others its force is added in each step. A
   rigid body feels it at its centre and flies as its first particle: only that one has a flight. Reads bodies and the
   law; writes bodies, their bounds and timers. Promises: a flight is a parabola from its origin to its end, computed at
   its origin, and the same whatever is skipped. */
#pragma once
#include "../search/timers.h"
#include "../particles/exits.h"
#include "view.h"

/* Tasks of the kernel of a field, which DEM_FORCE_FIELD makes from a law. */
enum {
    DEM__FIND_FLIGHTS,   /* begins flights of particles now */
    DEM__RENEW_FLIGHTS,  /* keeps the flights that the law still gives, and begins the others again */
    DEM__END_FLIGHTS,    /* ends flights of particles now; from here on they take steps */
    DEM__ADD_FIELD_FORCE /* adds the force on particles at the end of the present step, of length h */
};
typedef struct dem__field_task {
    int task;
    const int32_t *particle;
    ptrdiff_t n;
    double h; /* [s] */
} dem__field_task;

DEM_INLINE double dem__time_of(const dem_world *w, int64_t step) {
    return w->engine->run.start_time + (double)(step - w->engine->run.start_step) * w->engine->run.dt;
}

DEM_INLINE int dem__is_zero(dem_vec v) { return v.x == 0.0 && v.y == 0.0 && v.z == 0.0; }

/* Returns what a law is told about particle i at x with velocity v, tau after its origin step. seen: room for what it
   asks about the shape of a body. */
DEM_INLINE dem_force_point dem__field_point(const dem_world *w, ptrdiff_t i, dem_vec x, dem_vec v, double time,
                                            double tau, dem__seen *seen) {
    dem_force_point at;
    at.position = w->engine->run.has_periodic ? dem__in_box(w, x) : x;
    at.velocity = v;
    at.radius = 0.5 * dem__diameter_of(w, i), at.mass = w->particle[i].mass;
    at.time = time;
    at.gravity = dem__free_fall(w);
    at.user = w->engine->field.def.user;
    at.body__ = dem__look_at(w, i, tau, seen);
    return at;
}

/* Returns the acceleration of particle i at x with velocity v by the law, tau after its origin step [m/s2]. */
DEM_INLINE dem_vec dem__field_pull(const dem_world *w, ptrdiff_t i, dem_vec x, dem_vec v, double time, double tau,
                                   dem_vec (*law)(const dem_force_point *)) {
    dem__seen seen;
    const dem_force_point at = dem__field_point(w, i, x, v, time, tau, &seen);
    return dem__scale(w->engine->bodies.sum[i].per_mass, law(&at));
}

/* A law of torque: -c times the spin relative to the field. *spin: in, of a particle [rad/s]; out, relative to the
   field. Returns c [N m s]. NULL: no torque. */
typedef double (*dem__turning_fn)(const dem_force_point *at, dem_vec *spin);

/* The torque of a field on a particle: c, the relative spin, and the particle's moment of inertia about it. */
typedef struct dem__turning {
    double c, inertia; /* c = 0: none */
    dem_vec spin;
} dem__turning;
/* Returns the torque on particle i, which spins, or on its body. The velocity of the point does not count. */
DEM_INLINE dem__turning dem__turning_of(const dem_world *w, ptrdiff_t i, const dem_force_point *at, dem_vec spin,
                                        dem__turning_fn turning) {
    const dem__rigid *r = dem__rigid_of(w, i);
    dem__turning q;
    q.spin = spin, q.c = 0.0, q.inertia = 1.0;
    if (!turning || (!r && !w->engine->run.has_friction && dem__is_zero(spin)))
        return q; /* spheres without friction do not turn */
    q.c = turning(at, &q.spin);
    const double square = dem__dot(q.spin, q.spin);
    if (!(q.c > 0.0 && square > 0.0 && square <= DBL_MAX)) {
        q.c = 0.0;
        return q;
    }
    q.inertia = r ? dem__dot(q.spin, dem__momentum_of(r->turn, r->moments, q.spin)) / square : dem__inertia(w, i);
    return q;
}

/* Lets the torque act on particle i, or its body, over a past time, at an origin that has just been set. Exact for a
   sphere if c is constant. Returns the energy gained [J]. */
DEM_INLINE double dem__apply_drag_torque(dem_world *w, ptrdiff_t i, double passed, const dem__turning *q) {
    const double before = dem__rotational(w, i), y = q->c * passed / q->inertia;
    const double part = y < 1e-3 ? 1.0 - y * (0.5 - y * (1.0 / 6.0 - y / 24.0)) : (1.0 - riddle_exp(-y)) / y;
    dem__add_angular_momentum(w, i, dem__scale(-q->c * passed * part, q->spin));
    return dem__rotational(w, i) - before;
}

/* Returns whether free fall is the only acceleration of particle i, or of its body. */
DEM_INLINE int dem__falls_freely(const dem_world *w, ptrdiff_t i) {
    return dem__is_zero(dem__sub(dem__centre_pull(w, i), dem__free_fall(w)));
}

/* Result of one step of a flight. */
typedef struct dem__flown {
    dem_vec way;  /* displacement over time, minus the initial velocity [m/s] */
    dem_vec gain; /* gain of velocity at the end [m/s] */
    double work;  /* work of the field [J] */
    double error; /* error of position [m] */
    int zero;     /* whether the law gave 0 at every stage */
} dem__flown;

/* Integrates one step of length h from x with velocity v, tau after the particle's origin step: of fifth order, with an
   error estimate of fourth order (Cash & Karp 1990). A body turns meanwhile as it does without a torque. */
DEM_INLINE dem__flown dem__fly(const dem_world *w, ptrdiff_t i, dem_vec x, dem_vec v, double time, double tau, double h,
                               dem_vec (*law)(const dem_force_point *)) {
    enum { STAGES = 6 };
    static const double at[STAGES] = {0.0, 0.2, 0.3, 0.6, 1.0, 0.875};
    static const double by[STAGES][STAGES - 1] = {
        {0.0, 0.0, 0.0, 0.0, 0.0},
        {0.2, 0.0, 0.0, 0.0, 0.0},
        {3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0},
        {0.3, -0.9, 1.2, 0.0, 0.0},
        {-11.0 / 54.0, 2.5, -70.0 / 27.0, 35.0 / 27.0, 0.0},
        {1631.0 / 55296.0, 175.0 / 512.0, 575.0 / 13824.0, 44275.0 / 110592.0, 253.0 / 4096.0}};
    static const double fifth[STAGES] = {37.0 / 378.0, 0.0, 250.0 / 621.0, 125.0 / 594.0, 0.0, 512.0 / 1771.0};
    static const double fourth[STAGES] = {2825.0 / 27648.0, 0.0, 18575.0 / 48384.0, 13525.0 / 55296.0,
                                          277.0 / 14336.0,  0.25};
    const dem_vec g = dem__free_fall(w), none = dem_vec3(0.0, 0.0, 0.0);
    dem_vec gain[STAGES], pull[STAGES], off = none, error = none;
    dem__flown q;
    q.way = q.gain = none, q.work = 0.0, q.zero = 1;
    for (int s = 0; s < STAGES; s++) {
        dem_vec way = none;
        gain[s] = none;
        for (int r = 0; r < s; r++) {
            gain[s] = dem__plus(gain[s], h * by[s][r], dem__add(g, pull[r]));
            way = dem__plus(way, h * by[s][r], gain[r]);
        }
        const dem_vec now = dem__add(v, gain[s]);
        pull[s] = dem__field_pull(w, i, dem__add(dem__plus(x, at[s] * h, v), way), now, time + at[s] * h,
                                  tau + at[s] * h, law);
        q.zero &= dem__is_zero(pull[s]);
        q.way = dem__plus(q.way, fifth[s], gain[s]);
        q.gain = dem__plus(q.gain, h * fifth[s], dem__add(g, pull[s]));
        q.work += h * fifth[s] * w->particle[i].mass * dem__dot(pull[s], now);
        off = dem__plus(off, h * (fifth[s] - fourth[s]), gain[s]);
        error = dem__plus(error, h * h * (fifth[s] - fourth[s]), pull[s]);
    }
    q.error = dem__length(off) + dem__length(error);
    return q;
}

/* Returns the number of steps of the world in a time [s], at least one, and at most as many as a list can last. */
DEM_INLINE int dem__steps_within(const dem_world *w, double time) {
    const double n = time * w->engine->pairs.steps_per_second;
    return n >= (double)(DEM__STEPS_MAX - 2) ? DEM__STEPS_MAX - 2 : n > 1.0 ? (int)n : 1; /* NaN: one */
}

#define DEM__SLOWS 5e-3 /* share of its spin that a particle may lose in a flight */

/* Chooses the number of steps of a flight from x with velocity v, tau after the particle's origin step, by its error,
   and computes the flight. A parabola that is right at both ends has an error of position of 1/13.5 of the difference
   between its acceleration and the first one, times the time squared. */
DEM_INLINE int dem__choose_flight(const dem_world *w, ptrdiff_t i, dem_vec x, dem_vec v, double tau,
                                  const dem__turning *turn, dem__flown *q, dem_vec (*law)(const dem_force_point *)) {
    const dem_force_field *def = &w->engine->field.def;
    const double dt = w->engine->run.dt, time = w->time, limit = def->accuracy * 0.5 * dem__diameter_of(w, i),
                 probe = 16.0 * dt;
    const dem_vec first = dem__field_pull(w, i, x, v, time, tau, law), a = dem__add(dem__free_fall(w), first);
    const dem_vec there = dem__plus(x, probe, dem__plus(v, 0.5 * probe, a));
    const dem_vec soon = dem__field_pull(w, i, there, dem__plus(v, probe, a), time + probe, tau + probe, law);
    const double jerk = dem__length(dem__sub(soon, first)) / probe;
    const double far = dem__time_to_cover(def->length, dem__length(v), dem__length(a));
    double longest = far < def->interval ? far : def->interval;
    if (jerk > 0.0) {
        const double guess = riddle_cbrt(13.5 * 3.0 * limit / jerk);
        longest = guess < longest ? guess : longest;
    }
    if (turn->c > 0.0) { /* the spin at the beginning counts for the whole flight, so it must not change much if it
                            matters */
        const double slows = DEM__SLOWS * turn->inertia / turn->c;
        longest = slows < longest && dem__length(turn->spin) * slows > def->accuracy ? slows : longest;
    }
    int n = dem__steps_within(w, longest);
    for (;;) {
        const double h = (double)n * dt;
        *q = dem__fly(w, i, x, v, time, tau, h, law);
        const double bent = dem__length(dem__sub(dem__scale(2.0 / h, q->way), a)) * h * h / 13.5;
        const double error = bent > 100.0 * q->error ? bent : 100.0 * q->error; /* errors of the ends add up */
        if (n == 1 || error <= limit) return n;
        const double part = 0.9 * riddle_cbrt(limit / error);
        const int fewer = (int)((part > 0.1 ? part : 0.1) * (double)n); /* NaN: a tenth */
        n = fewer > 1 ? fewer : 1;
    }
}

/* Begins a flight now, after the torque of the one before. The present parabola stays where the law gives 0 as before,
   and there is no torque. */
DEM_INLINE void dem__find_flight(dem_world *w, ptrdiff_t i, dem_vec (*law)(const dem_force_point *),
                                 dem__turning_fn turning) {
    dem__field *field = &w->engine->field;
    const double tau = dem__now(w, i), dt = w->engine->run.dt, passed = field->until[i] == DEM__NO_FLIGHT ? 0.0 : tau;
    const dem_vec x = dem__centre_at(w, i, tau),
                  v = field->until[i] == w->step ? field->end_velocity[i] : dem__drift_at(w, i, tau);
    const dem_vec g = dem__free_fall(w), spin = turning ? dem__spin_at(w, i, tau) : dem_vec3(0.0, 0.0, 0.0);
    dem__seen seen;
    const dem_force_point at = dem__field_point(w, i, x, v, w->time, tau, &seen);
    const dem__turning turn = dem__turning_of(w, i, &at, spin, turning);
    const int brakes = turn.c > 0.0 && passed > 0.0, falls = dem__falls_freely(w, i) && !brakes,
              is_body = at.body__ != NULL;
    dem__flown q;
    double since = tau;
    int n = 0;
    field->booked[i] = 0.0;
    if (is_body && !(falls && dem__is_zero(law(&at)))) { /* its law sees how it turns from this origin on */
        dem__begin_parabola(w, i, x, v, g), since = 0.0;
        if (brakes) field->booked[i] = -dem__apply_drag_torque(w, i, passed, &turn); /* the next booking adds it */
    }
    n = dem__choose_flight(w, i, x, v, since, &turn, &q, law);
    if (is_body && since > 0.0 && !q.zero) { /* the law begins to act later */
        dem__begin_parabola(w, i, x, v, g);
        n = dem__choose_flight(w, i, x, v, 0.0, &turn, &q, law);
    }
    const double h = (double)n * dt;
    field->until[i] = w->step + n;
    field->work[i] = q.work;
    field->force[i] = dem_vec3(0.0, 0.0, 0.0); /* it is in the parabola */
    if (!(q.zero && falls)) {
        dem__begin_parabola(w, i, x, v, q.zero ? g : dem__scale(2.0 / h, q.way));
        if (brakes && !is_body) field->booked[i] = -dem__apply_drag_torque(w, i, passed, &turn);
    }
    field->end_velocity[i] =
        q.zero ? dem__drift_at(w, i, (double)(w->step + n - w->particle[i].origin) * dt) : dem__add(v, q.gain);
}

/* Returns whether the flight of particle i is what the law gives from its origin; where that is 0, whether it stays 0
   to the end. If so, computes the velocity at its end and the work. */
DEM_INLINE int dem__is_flight(dem_world *w, ptrdiff_t i, dem_vec (*law)(const dem_force_point *)) {
    dem__field *field = &w->engine->field;
    const int64_t end = field->until[i], last = w->step + DEM__STEPS_MAX, origin = w->particle[i].origin;
    const dem_vec pull = dem__centre_pull(w, i);
    const double dt = w->engine->run.dt, tau = dem__now(w, i);
    if (!(end > w->step && end < last && origin <= w->step && end - origin < 2 * (int64_t)last)) return 0;
    const int zero = dem__falls_freely(w, i);
    const double h = (double)(end - (zero ? w->step : origin)) * dt, from = zero ? tau : 0.0;
    const dem_vec v = dem__drift_at(w, i, from);
    const dem__flown q =
        dem__fly(w, i, dem__centre_at(w, i, from), v, zero ? w->time : dem__time_of(w, origin), from, h, law);
    const dem_vec a = dem__scale(2.0 / h, q.way);
    if (zero != q.zero || (zero && h * dem__length(v) > 2.0 * field->def.length)) return 0;
    if (!zero && !(a.x == pull.x && a.y == pull.y && a.z == pull.z)) return 0;
    field->end_velocity[i] = zero ? dem__drift_at(w, i, (double)(end - origin) * dt) : dem__add(v, q.gain);
    field->work[i] = q.work;
    return 1;
}

/* Ends the flight of particle i now, at its position on the parabola. Its velocity is computed again. */
DEM_INLINE void dem__end_flight(dem_world *w, ptrdiff_t i, dem_vec (*law)(const dem_force_point *),
                                dem__turning_fn turning) {
    dem__field *field = &w->engine->field;
    dem__rigid *r = dem__rigid_of(w, i);
    const dem_vec a = dem__centre_pull(w, i);
    const double tau = dem__now(w, i), passed = field->until[i] == DEM__NO_FLIGHT ? 0.0 : tau;
    const dem_vec x = dem__centre_at(w, i, tau), spin = turning ? dem__spin_at(w, i, tau) : dem_vec3(0.0, 0.0, 0.0);
    dem_vec v = dem__drift_at(w, i, tau);
    const int falls = dem__falls_freely(w, i);
    field->work[i] = 0.0;
    if (tau > 0.0 && !falls) {
        const dem_vec begun = dem__drift_at(w, i, 0.0);
        const dem__flown q =
            dem__fly(w, i, dem__centre_at(w, i, 0.0), begun, dem__time_of(w, w->particle[i].origin), 0.0, tau, law);
        v = dem__add(begun, q.gain);
        field->work[i] = q.work;
    }
    dem__seen seen;
    const dem_force_point at = dem__field_point(w, i, x, v, w->time, tau, &seen);
    const dem_vec pull = dem__scale(w->engine->bodies.sum[i].per_mass, law(&at));
    const dem__turning turn = dem__turning_of(w, i, &at, spin, turning);
    const int brakes = turn.c > 0.0 && passed > 0.0;
    field->force[i] = dem__scale(w->particle[i].mass, pull);
    field->until[i] = DEM__NO_FLIGHT;
    if (falls && dem__is_zero(pull) && !brakes) return; /* the same bits as without a field */
    dem__begin_parabola(w, i, x, v, a);
    if (brakes) field->work[i] += dem__apply_drag_torque(w, i, passed, &turn);
    dem__free_acceleration(w, i);
    if (!r) w->particle[i].a = dem__add(w->particle[i].a, pull);
}

/* Adds the law's force and torque on particle i, which takes steps, at its position after a step of h and at the
   velocity predicted for it. The force on a body is added where its forces are summed. */
DEM_INLINE void dem__add_field_force(dem_world *w, ptrdiff_t i, double h, dem_vec (*law)(const dem_force_point *),
                                     dem__turning_fn turning) {
    const dem__rigid *r = dem__rigid_of(w, i);
    const dem_particle *p = &w->particle[i];
    const dem_vec none = dem_vec3(0.0, 0.0, 0.0), v = r ? r->v : p->v;
    w->engine->field.torque[i] = none;
    if (!dem__leads(w, i)) {
        w->engine->field.force[i] = none;
        return;
    }
    dem__seen seen;
    const dem_force_point at = dem__field_point(w, i, r ? r->x : p->x, dem__plus(v, 0.5 * h, dem__centre_pull(w, i)),
                                                dem__time_of(w, w->step + (h > 0.0)), 0.0, &seen);
    const dem_vec pull = dem__scale(w->engine->bodies.sum[i].per_mass, law(&at));
    const dem_vec force = dem__scale(p->mass, pull);
    double *load = w->engine->bodies.sum[i].load;
    if (!r) load[0] += force.x, load[1] += force.y, load[2] += force.z;
    w->engine->field.force[i] = force;
    if (!turning) return;
    const dem__turning turn = dem__turning_of(w, i, &at, p->spin, turning);
    const double most = turn.inertia / w->engine->run.dt; /* stops the spin in a step: more would overshoot and grow */
    const dem_vec torque = turn.c > 0.0 ? dem__scale(-(turn.c < most ? turn.c : most), turn.spin) : none;
    load[3] += torque.x, load[4] += torque.y, load[5] += torque.z;
    w->engine->field.torque[i] = torque;
}

DEM_INLINE void dem__field_kernel(dem_world *w, const dem__field_task *q, dem_vec (*law)(const dem_force_point *),
                                  dem__turning_fn turning) {
    for (ptrdiff_t k = 0; k < q->n; k++) {
        const ptrdiff_t i = q->particle[k];
        if (q->task == DEM__ADD_FIELD_FORCE) dem__add_field_force(w, i, q->h, law, turning);
        else if (q->task == DEM__END_FLIGHTS) dem__end_flight(w, i, law, turning);
        else if (q->task == DEM__FIND_FLIGHTS || !dem__is_flight(w, i, law)) dem__find_flight(w, i, law, turning);
    }
}

/* turning: a law of torque, or NULL. */
#define DEM__FIELD(name, law, turning)                                                                                 \
    DEM__FAST static DEM__NOINLINE int name(dem_world *world, const struct dem__field_task *task) {                    \
        dem__field_kernel(world, task, law, turning);                                                                  \
        return 1;                                                                                                      \
    }
#define DEM_FORCE_FIELD(name, law) DEM__FIELD(name, law, NULL)
