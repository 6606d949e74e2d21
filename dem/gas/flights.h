/* Flights in a force field within a step: their begin and end, timers, bounds and work; and setting a field. */
#pragma once
#include "../step/integrate.h"
#include "../records/groups.h"
#include "field.h"

/* Runs a task of the kernel for a part of a list of particles. */
static inline void dem__run_field_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    dem__field_task q = *(const dem__field_task *)context;
    (void)part;
    q.n = end - first;
    if (q.n > 0) q.particle += first;
    w->engine->field.def.kernel(w, &q);
}
/* Runs a task of the kernel for a list of particles, on one thread or several. */
static inline void dem__run_field(dem_world *w, const int32_t *particle, ptrdiff_t n, int task, double h) {
    dem__field_task q;
    memset(&q, 0, sizeof q);
    q.particle = particle, q.n = n, q.task = task, q.h = h;
    dem__in_parts(w, dem__parts(w, 4 * n), n, dem__run_field_range, &q);
}

/* Returns the work of the field along a flight so far [J]: the energy that the particle has gained since its origin. */
static inline double dem__flight_gain(const dem_world *w, ptrdiff_t i) {
    const double tau = dem__now(w, i);
    const dem_vec u = dem__drift_at(w, i, 0.0), v = dem__drift_at(w, i, tau), g = dem__free_fall(w);
    const dem_vec way = dem__sub(dem__centre_at(w, i, tau), dem__centre_at(w, i, 0.0));
    const double gain = 0.5 * (dem__dot(v, v) - dem__dot(u, u)) - dem__dot(g, way);
    return dem__falls_freely(w, i) ? 0.0 : w->particle[i].mass * gain;
}

/* Returns whether particle i, or the body that it leads, is in flight. */
DEM_INLINE int dem__is_flying(const dem_world *w, ptrdiff_t i) {
    return w->alive[i] > 0 && w->engine->bodies.activity[i] == DEM__FLYING && dem__leads(w, i);
}

/* Treats the work of the field on all flights so far as booked, because the ledger begins or all flights have been
   found again. */
static inline void dem__begin_field_ledger(dem_world *w) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (dem__is_flying(w, i)) w->engine->field.booked[i] = dem__flight_gain(w, i);
    }
}

/* Books the work of the field on all flights so far, or only on those of particles that leave. */
static inline void dem__book_flights(dem_world *w, int leaving) {
    dem__field *field = &w->engine->field;
    for (ptrdiff_t i = 0; i < w->count && w->engine->ledger.on; i++) {
        if ((leaving ? w->alive[i] != DEM_LEAVING : w->alive[i] <= 0) || field->until[i] == DEM__NO_FLIGHT) continue;
        const double gain = dem__flight_gain(w, i);
        dem__book_field_work(w, gain - field->booked[i]);
        field->booked[i] = gain;
    }
}

/* Returns how far the velocity of particle k, which flies with i, can depart from that of its bound until the end of
   the flight [m/s]. */
DEM_INLINE double dem__flight_deviation(const dem_world *w, ptrdiff_t i, ptrdiff_t k) {
    const dem__field *field = &w->engine->field;
    const dem__bound *c = &w->engine->bodies.bound[k];
    const double t = dem__since_listed(w, w->step), left = (double)(field->until[i] - w->step) * w->engine->run.dt;
    const dem_vec g = dem__free_fall(w), u = dem_vec3(c->ux, c->uy, c->uz);
    const dem_vec now = dem__sub(dem__plus(dem__drift_at(w, i, dem__now(w, i)), -t, g), u);
    const double here = dem__length(now),
                 there = dem__length(dem__plus(now, left, dem__sub(dem__centre_pull(w, i), g))),
                 end = dem__length(dem__sub(dem__plus(field->end_velocity[i], -(t + left), g), u));
    const double most = here > there ? here : there;
    return (most > end ? most : end) + dem__turning_speed_of(w, k);
}

/* Sets a bound for particle k, which flies with i. It holds for about DEM__FLIGHTS flights like this one. */
static inline void dem__bound_flight(dem_world *w, ptrdiff_t i, ptrdiff_t k) {
    const dem__field *field = &w->engine->field;
    const dem__pairs *pairs = &w->engine->pairs;
    const double t = dem__since_listed(w, w->step), tau = dem__now(w, i), dt = w->engine->run.dt;
    const double left = (double)(field->until[i] - w->step) * dt;
    const dem_vec g = dem__free_fall(w), x = dem__at(w, k, tau), v = dem__drift_at(w, i, tau);
    const dem_vec turn = dem__scale(0.5 * DEM__FLIGHTS * left, dem__sub(dem__centre_pull(w, i), g)),
                  u = dem__add(v, turn);
    dem__bound *c = &w->engine->bodies.bound[k];
    c->ux = u.x - t * g.x, c->uy = u.y - t * g.y, c->uz = u.z - t * g.z;
    c->x = x.x - t * (u.x - 0.5 * t * g.x), c->y = x.y - t * (u.y - 0.5 * t * g.y),
    c->z = x.z - t * (u.z - 0.5 * t * g.z);
    const double turned = 1.1 * dem__length(turn), most = 1.1 * dem__flight_deviation(w, i, k);
    c->tolerance = 0.001 * pairs->least_tolerance + (turned > most ? turned : most);
    c->reach = w->particle[k].radius + pairs->position_tolerance - t * c->tolerance;
    w->engine->bodies.shifted[k] = 0.0;
}

/* Sets the timers of n flights that have just been computed, and new bounds for particles that leave theirs. Returns 0
   if one is too fast. */
static inline int dem__follow_flights(dem_world *w, const int32_t *list, ptrdiff_t n) {
    dem__field *field = &w->engine->field;
    dem__bodies *bodies = &w->engine->bodies;
    const dem__list_frame frame = dem__frame_at(w, w->step);
    dem__outcome outcome = dem__no_outcome(w);
    ptrdiff_t reset = 0;
    for (ptrdiff_t q = 0; q < n; q++) {
        const int32_t i = list[q];
        const ptrdiff_t end = dem__pieces_of(w, i).end;
        const double tau = dem__now(w, i);
        if (w->engine->run.has_periodic && w->particle[i].origin == w->step) dem__wrap(w, i);
        dem__set_timer(&field->timers, i, field->until[i]);
        for (int32_t k = i; k < end; k++) {
            if (dem__flight_deviation(w, i, k) < bodies->bound[k].tolerance) continue; /* false for NaN */
            const double shifted = bodies->shifted[k];
            dem__bound_flight(w, i, k);
            w->engine->scratch.index[reset++] = k;
            if (dem__apply_bound(w, k, w->step, &frame, dem__at(w, k, tau), dem__velocity_at(w, k, tau), shifted,
                                 &outcome))
                dem__advance_wall_timers(w, k, w->step);
        }
    }
    dem__apply_outcome(w, &outcome);
    dem__reset_pair_timers(w, w->engine->scratch.index, reset, w->step);
    return w->status == DEM_OK;
}

/* Returns whether particle i, which takes steps, has the acceleration that it has without contacts and without the
   field. Always 0 for a body and for a fixed particle. */
static inline int dem__feels_no_field(const dem_world *w, ptrdiff_t i) {
    if (!dem__is_free_sphere(w, i)) return 0;
    const dem_vec a =
        dem__plus(dem__free_fall(w), w->engine->bodies.sum[i].per_mass, dem__first(w->engine->bodies.load[i]));
    return dem__is_zero(dem__sub(w->particle[i].a, a));
}

/* Sets timers and bounds of all flights for a new list of near pairs. Returns 0 after a failure. */
static inline int dem__list_flights(dem_world *w) {
    dem__field *field = &w->engine->field;
    ptrdiff_t n = 0;
    if (!dem__grow_timers(w, &field->timers, w->count, &field->stepping, sizeof *field->stepping)) {
        w->status = DEM_OUT_OF_MEMORY;
        return 0;
    }
    dem__stop_timers(&field->timers, 0, w->count);
    field->timers.from = w->step;
    field->rebuilds = w->rebuilds;
    for (int32_t i = 0; i < (int32_t)w->count; i++) {
        field->timers.list[n] = i;
        n += dem__is_flying(w, i);
    }
    return dem__follow_flights(w, field->timers.list, n);
}

/* Prepares a run: begins the flights of new particles, and again those that the caller has changed. Returns 0 after a
   failure. */
static inline int dem__prepare_flights(dem_world *w) {
    dem__field *field = &w->engine->field;
    ptrdiff_t n = 0, ended = 0;
    if (!dem__find_views(w) ||
        !dem__grow_timers(w, &field->timers, w->count, &field->stepping, sizeof *field->stepping)) {
        w->status = DEM_OUT_OF_MEMORY;
        return 0;
    }
    for (int32_t i = 0; i < (int32_t)w->count; i++) {
        field->timers.list[n] = field->stepping[ended] = i;
        n += dem__is_flying(w, i);
        ended += w->alive[i] > 0 && dem__leads(w, i) && !dem__is_flying(w, i) &&
                 (field->until[i] != DEM__NO_FLIGHT || dem__feels_no_field(w, i));
        if (w->alive[i] <= 0 || field->until[i] <= w->step) field->until[i] = DEM__NO_FLIGHT;
    }
    dem__run_field(w, field->stepping, ended, DEM__END_FLIGHTS, 0.0);
    dem__run_field(w, field->timers.list, n, DEM__RENEW_FLIGHTS, 0.0);
    dem__begin_field_ledger(w);
    field->steppers = 0;
    return dem__list_flights(w);
}

/* Begins the next flight where one is over, before a step. Returns 0 after a failure. */
static inline int dem__continue_flights(dem_world *w) {
    dem__field *field = &w->engine->field;
    ptrdiff_t n, flying = 0;
    int32_t *list = field->timers.list;
    if (field->rebuilds != w->rebuilds && !dem__list_flights(w)) return 0;
    dem__list_due(&field->timers, 0, field->timers.pages, w->step, DEM__STOPPED, &n);
    for (ptrdiff_t k = 0; k < n; k++) {
        const int32_t i = list[k];
        if (!dem__is_flying(w, i)) continue;
        dem__book_field_work(w, field->work[i] - field->booked[i]);
        list[flying++] = i;
    }
    if (flying == 0) return 1;
    dem__run_field(w, list, flying, DEM__FIND_FLIGHTS, 0.0);
    return dem__follow_flights(w, list, flying);
}

/* Ends the flights of particles whose contacts begin, in the slots that contacts.slots lists. */
static inline void dem__end_flights(dem_world *w, ptrdiff_t begun) {
    dem__field *field = &w->engine->field;
    const dem__contacts *contacts = &w->engine->contacts;
    const double t = dem__since_listed(w, w->step);
    for (ptrdiff_t k = 0; k < 2 * begun; k++) {
        const int32_t c = contacts->slots[k / 2], touched = k % 2 ? contacts->j[c] : contacts->i[c];
        if (touched < 0) continue;
        const dem__pieces own = dem__pieces_of(w, touched);
        const int32_t i = (int32_t)own.first;
        if (field->until[i] == DEM__NO_FLIGHT) continue;
        const double booked = field->booked[i];
        dem__run_field(w, &i, 1, DEM__END_FLIGHTS, 0.0);
        dem__book_field_work(w, field->work[i] - booked);
        for (ptrdiff_t q = own.first; q < own.end; q++)
            dem__set_tolerance_left(w, q, dem__length(dem__deviation(w, q, t)));
        dem__stop_timer(&field->timers, i);
    }
}

/* Books half of the work that the present forces do on the particles that take steps. */
static inline void dem__book_stepping(dem_world *w, double h) {
    for (ptrdiff_t k = 0; k < w->engine->bodies.active_count && w->engine->ledger.on && h > 0.0; k++) {
        const ptrdiff_t i = w->engine->bodies.active[k];
        dem__book_field_work(w, 0.5 * h * dem__dot(w->engine->field.force[i], dem__centre_velocity(w, i)));
        dem__book_field_work(w, 0.5 * h * dem__dot(w->engine->field.torque[i], w->particle[i].spin));
    }
}

/* Adds the field's forces on the particles that take steps, at the end of a step, and lists these particles. Books the
   work from the mean of the forces at both ends. */
static inline void dem__add_field_forces(dem_world *w, double h) {
    dem__field *field = &w->engine->field;
    const dem__bodies *bodies = &w->engine->bodies;
    const ptrdiff_t n = bodies->active_count;
    if (n > 0) memcpy(field->stepping, bodies->active, (size_t)n * sizeof *bodies->active);
    field->steppers = n;
    dem__book_stepping(w, h);
    dem__run_field(w, bodies->active, n, DEM__ADD_FIELD_FORCE, h);
    dem__book_stepping(w, h);
}

/* Begins flights of particles whose last contact has ended, after a step. Returns 0 after a failure. */
static inline int dem__begin_flights(dem_world *w) {
    dem__field *field = &w->engine->field;
    int32_t *list = field->stepping;
    ptrdiff_t n = 0;
    for (ptrdiff_t k = 0; k < field->steppers; k++) {
        const int32_t i = list[k];
        if (dem__is_flying(w, i)) list[n++] = i;
        else if (w->alive[i] > 0 && w->touching[i] == 0 && dem__is_free_sphere(w, i)) { /* it has a load */
            dem__free_acceleration(w, i); /* rounded as after a check of its bound */
            w->particle[i].a = dem__plus(w->particle[i].a, w->engine->bodies.sum[i].per_mass, field->force[i]);
        }
    }
    field->steppers = 0;
    if (n == 0) return 1;
    dem__run_field(w, list, n, DEM__FIND_FLIGHTS, 0.0);
    return dem__follow_flights(w, list, n);
}

/* Returns the error of a velocity on the parabola of a flight in a force field [m/s]. The parabola has the right
   positions at both ends, but not the right velocities. The error at its end shows how the acceleration changes along
   it. */
static inline dem_vec dem__velocity_error_in_field(const dem_world *w, ptrdiff_t i, double tau) {
    const dem__field *field = &w->engine->field;
    const ptrdiff_t first = dem__pieces_of(w, i).first; /* the flight belongs to it */
    const dem_vec none = dem_vec3(0.0, 0.0, 0.0);
    if (w->engine->bodies.activity[i] || field->until[first] == DEM__NO_FLIGHT) return none;
    const double whole = (double)(field->until[first] - w->particle[i].origin) * w->engine->run.dt, share = tau / whole;
    if (!(share >= 0.0 && share <= 1.0)) return none;
    return dem__scale(share * (3.0 * share - 2.0), dem__sub(field->end_velocity[first], dem__drift_at(w, i, whole)));
}

/* Gives particle i, or its body, the most accurate velocity that is known, at an origin that has just been set. */
static inline void dem__correct_velocity_in_field(dem_world *w, ptrdiff_t i, dem_vec error) {
    dem__book_field_work(w, -dem__motion_energy(w, i));
    dem__add_velocity(w, i, error);
    dem__book_field_work(w, dem__motion_energy(w, i));
}

/* ---- the feature ---- */

/* Lists the arrays of particles in a force field. Returns how many. */
static inline int dem__list_arrays_of_field(dem_world *w, dem__array *list) {
    dem__field *field = &w->engine->field;
    const dem__array arrays[] = {
        {&field->until, sizeof *field->until},    {&field->end_velocity, sizeof *field->end_velocity},
        {&field->force, sizeof *field->force},    {&field->torque, sizeof *field->torque},
        {&field->work, sizeof *field->work},      {&field->booked, sizeof *field->booked},
        {&field->view_of, sizeof *field->view_of}};
    const int n = (int)(sizeof arrays / sizeof *arrays);
    memcpy(list, arrays, sizeof arrays);
    return n;
}

static inline void dem__release_field(dem_world *w) {
    dem__release(&w->def.allocator, w->engine->field.timers.block, w->engine->field.timers.bytes);
    dem__release_views(w);
}

static inline void dem__add_unflown(dem_world *w, ptrdiff_t i) {
    w->engine->field.until[i] = DEM__NO_FLIGHT, w->engine->field.view_of[i] = 0;
    w->engine->field.force[i] = w->engine->field.torque[i] = dem_vec3(0.0, 0.0, 0.0);
}

/* Refuses a run in a field without a law: after loading, dem_set_force_field must come first. */
static inline dem_status dem__check_field(const dem_world *w, const dem_kernel *kernel) {
    (void)kernel;
    return w->engine->field.def.kernel ? DEM_OK : DEM_NO_FIELD;
}

/* Begins the next flight where one is over, so that a caller who changes particles finds none that is over. */
static inline int dem__end_run_in_field(dem_world *w, int going) {
    if (going) going = dem__continue_flights(w);
    dem__book_flights(w, 0);
    return going;
}

static inline void dem__leave_field(dem_world *w) { dem__book_flights(w, 1); }

static inline void dem__world_fields_of_field(dem_world *w, dem__group *g) {
    const dem__saved_field fields[] = {DEM__INTEGER("field.on", w->engine->field.on, 0)};
    dem__add_optional(g, fields, sizeof fields);
}

static inline void dem__particle_fields_of_field(dem_world *w, dem__group *g) {
    dem__field *field = &w->engine->field;
    const dem__saved_field fields[] = {
        DEM__INTEGER("particle.until", field->until[0], sizeof *field->until),
        DEM__DOUBLES("particle.end_velocity", field->end_velocity[0], sizeof *field->end_velocity),
        DEM__DOUBLES("particle.field_force", field->force[0], sizeof *field->force),
        DEM__DOUBLES("particle.field_torque", field->torque[0], sizeof *field->torque),
        DEM__DOUBLES("particle.field_work", field->work[0], sizeof *field->work),
    };
    dem__add_optional(g, fields, sizeof fields);
}

static inline int dem__has_field(const dem__file *file, const dem_world *w) {
    (void)file;
    return dem__is_flag(w->engine->field.on) ? w->engine->field.on : -1;
}

static inline dem_status dem__load_flights(const dem__file *file, dem_world *w, dem__group *g) {
    (void)file, (void)g;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->engine->field.until[i] < 0) return DEM_BAD_DATA;
    }
    return DEM_OK;
}

static inline dem__feature dem__feature_field(void) {
    dem__feature f = dem__new_feature(DEM__FIELD_FEATURE);
    f.exclusive = 1;
    f.list_arrays = dem__list_arrays_of_field;
    f.release = dem__release_field;
    f.add_particle = dem__add_unflown;
    f.check_run = dem__check_field;
    f.prepare_run = dem__prepare_flights;
    f.begin_ledger = dem__begin_field_ledger;
    f.end_run = dem__end_run_in_field;
    f.begin_step = dem__continue_flights;
    f.contacts_begun = dem__end_flights;
    f.add_forces = dem__add_field_forces;
    f.leave = dem__leave_field;
    f.begin_flights = dem__begin_flights;
    f.velocity_error = dem__velocity_error_in_field;
    f.correct_velocity = dem__correct_velocity_in_field;
    f.world_fields = dem__world_fields_of_field;
    f.particle_fields = dem__particle_fields_of_field;
    f.is_used = dem__has_field;
    f.load = dem__load_flights;
    return f;
}

DEM_API dem_force_field dem_default_force_field(dem_field_fn kernel, const void *user) {
    dem_force_field field;
    field.kernel = kernel;
    field.user = user;
    field.length = field.interval = HUGE_VAL;
    field.accuracy = 1e-6;
    return field;
}

/* Removes the field. Particles in flight fall freely from here on. */
static inline void dem__drop_field(dem_world *w) {
    dem__field *field = &w->engine->field;
    for (ptrdiff_t i = 0; i < w->count && field->on; i++) {
        if (!dem__is_flying(w, i)) continue;
        dem__restart(w, i);
        dem__free_acceleration(w, i);
    }
    dem__release(&w->def.allocator, field->timers.block, field->timers.bytes);
    dem__release_views(w);
    memset(field, 0, sizeof *field);
    dem__drop_feature(w, DEM__FIELD_FEATURE);
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
}

DEM_API dem_status dem_set_force_field(dem_world *world, const dem_force_field *field) {
    dem_world *w = world;
    if (dem__is_running(w)) return DEM_BUSY;
    if (dem__lacks_memory(w)) return DEM_BAD_ARGUMENT;
    if (!field) {
        dem__drop_field(w);
        return DEM_OK;
    }
    const int was_loaded = w->engine->field.on && !w->engine->field.def.kernel;
    if (!field->kernel) return dem__refuse(w, "field.kernel: NULL");
    if (!(field->length > 0.0)) return dem__refuse(w, "field.length: not above 0");
    if (!(field->interval > 0.0)) return dem__refuse(w, "field.interval: not above 0");
    if (!(field->accuracy >= 1e-12 && field->accuracy <= 1e-4))
        return dem__refuse(w, "field.accuracy: not 1e-12 .. 1e-4");
    if (!w->engine->field.on) {
        const dem_status status = dem__take_feature(w, dem__feature_field());
        if (status != DEM_OK) return status;
        w->engine->field.on = 1;
    }
    if (!was_loaded) w->engine->run.needs_forces = 1; /* otherwise the accelerations are already those of the field */
    w->engine->field.def = *field;
    w->engine->run.needs_lists = 1;
    return DEM_OK;
}
