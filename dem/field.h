/* ------------------------------------------------------------------------------------------- >>field */
/* A force field: particles in flight advance by steps of their own, the others get its force in each step. Reads bodies, the law; writes
   bodies, their bounds and timers. Promises: a flight is a parabola from its origin to its end, computed at its origin and the same
   whatever is skipped.
   May be changed here alone: how long a flight is, within the requested accuracy. */

/* Tasks of the kernel of a field. All that a field needs goes through it, so that a program without one compiles none of it. */
enum {
    DEM__FIND_FLIGHTS,    /* of particles: begins flights now */
    DEM__RENEW_FLIGHTS,   /* of particles: keeps the flights that the law still gives, begins the others anew */
    DEM__END_FLIGHTS,     /* of particles: ends flights now; from here on they take steps */
    DEM__ADD_FIELD_FORCE, /* on particles: at the end of the present step, of length h */
    DEM__PREPARE_FIELD,   /* before a run: dem__prepare_flights */
    DEM__FIELD_CONTACTS,  /* n contacts have begun: dem__end_flights */
    DEM__FIELD_FORCES,    /* on all particles that take steps: dem__add_field_forces */
    DEM__FIELD_FLIGHTS,   /* after a step: dem__begin_flights */
    DEM__FIELD_BOOKS,     /* the ledger begins: dem__begin_books */
    DEM__RUN_IN_FIELD     /* n steps */
};
typedef struct dem__field_task {
    int task;
    const int32_t *particle;
    ptrdiff_t n;
    double h;                 /* [s] */
    const dem_kernel *kernel; /* of contacts */
} dem__field_task;

/* Runs one of the tasks that need only a number. Returns 0 after a failure. */
static inline int dem__ask_field(dem_world *w, int task, ptrdiff_t n) {
    dem__field_task q;
    memset(&q, 0, sizeof q);
    q.task = task, q.n = n;
    return w->engine->field.def.kernel(w, &q);
}
static inline int dem__ask_field_to_run(dem_world *w, ptrdiff_t steps, const dem_kernel *kernel) {
    dem__field_task q;
    memset(&q, 0, sizeof q);
    q.task = DEM__RUN_IN_FIELD, q.n = steps, q.kernel = kernel;
    return w->engine->field.def.kernel(w, &q);
}

DEM_INLINE double dem__time_of(const dem_world *w, int64_t step) {
    return w->engine->run.start_time + (double)(step - w->engine->run.start_step) * w->engine->run.dt;
}

/* Returns the acceleration of particle i at x with v by the law [m/s2]. */
DEM_INLINE dem_vec dem__field_pull(const dem_world *w, ptrdiff_t i, dem_vec x, dem_vec v, double time,
                                   dem_vec (*law)(const dem_force_point *)) {
    dem_force_point at;
    at.position = w->engine->run.has_periodic ? dem__in_box(w, x) : x;
    at.velocity = v;
    at.radius = w->particle[i].radius, at.mass = w->particle[i].mass;
    at.time = time;
    at.gravity = dem__free_fall(w);
    at.user = w->engine->field.def.user;
    return dem__scale(w->engine->bodies.sum[i].per_mass, law(&at));
}

DEM_INLINE int dem__is_zero(dem_vec v) { return v.x == 0.0 && v.y == 0.0 && v.z == 0.0; }

/* Result of one step of a flight. */
typedef struct dem__flown {
    dem_vec way;  /* mean gain of velocity: the displacement beyond that at the first velocity, over the time [m/s] */
    dem_vec gain; /* of velocity, at the end [m/s] */
    double work;  /* of the field [J] */
    double error; /* of position [m] */
    int zero;     /* whether the law gave 0 at every stage */
} dem__flown;

/* Integrates one step of h from x with v at a time: of fifth order, with the error of fourth order (Cash & Karp 1990). */
DEM_INLINE dem__flown dem__fly(const dem_world *w, ptrdiff_t i, dem_vec x, dem_vec v, double time, double h,
                               dem_vec (*law)(const dem_force_point *)) {
    enum { STAGES = 6 };
    static const double at[STAGES] = {0.0, 0.2, 0.3, 0.6, 1.0, 0.875};
    static const double by[STAGES][STAGES - 1] = {{0.0, 0.0, 0.0, 0.0, 0.0},
                                                  {0.2, 0.0, 0.0, 0.0, 0.0},
                                                  {3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0},
                                                  {0.3, -0.9, 1.2, 0.0, 0.0},
                                                  {-11.0 / 54.0, 2.5, -70.0 / 27.0, 35.0 / 27.0, 0.0},
                                                  {1631.0 / 55296.0, 175.0 / 512.0, 575.0 / 13824.0, 44275.0 / 110592.0, 253.0 / 4096.0}};
    static const double fifth[STAGES] = {37.0 / 378.0, 0.0, 250.0 / 621.0, 125.0 / 594.0, 0.0, 512.0 / 1771.0};
    static const double fourth[STAGES] = {2825.0 / 27648.0, 0.0, 18575.0 / 48384.0, 13525.0 / 55296.0, 277.0 / 14336.0, 0.25};
    const dem_vec g = dem__free_fall(w), none = dem_vec3(0.0, 0.0, 0.0);
    dem_vec gain[STAGES], pull[STAGES], off = none, stray = none;
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
        pull[s] = dem__field_pull(w, i, dem__add(dem__plus(x, at[s] * h, v), way), now, time + at[s] * h, law);
        q.zero &= dem__is_zero(pull[s]);
        q.way = dem__plus(q.way, fifth[s], gain[s]);
        q.gain = dem__plus(q.gain, h * fifth[s], dem__add(g, pull[s]));
        q.work += h * fifth[s] * w->particle[i].mass * dem__dot(pull[s], now);
        off = dem__plus(off, h * (fifth[s] - fourth[s]), gain[s]);
        stray = dem__plus(stray, h * h * (fifth[s] - fourth[s]), pull[s]);
    }
    q.error = dem__length(off) + dem__length(stray);
    return q;
}

/* Returns the number of steps of the world in a time [s], at least one, at most as many as a list can last. */
DEM_INLINE int dem__steps_within(const dem_world *w, double time) {
    const double n = time * w->engine->pairs.steps_per_second;
    return n >= (double)(DEM__STEPS_MAX - 2) ? DEM__STEPS_MAX - 2 : n > 1.0 ? (int)n : 1; /* NaN: one */
}

/* Chooses the number of steps of a flight from x with v by its error, and computes the flight. A parabola that is right at both ends has an
   error of position of 1/13.5 of the difference between its acceleration and the first one, times the time squared. */
DEM_INLINE int dem__choose_flight(const dem_world *w, ptrdiff_t i, dem_vec x, dem_vec v, dem__flown *q,
                                  dem_vec (*law)(const dem_force_point *)) {
    const dem_force_field *def = &w->engine->field.def;
    const double dt = w->engine->run.dt, time = w->time, limit = def->accuracy * w->particle[i].radius, probe = 16.0 * dt;
    const dem_vec first = dem__field_pull(w, i, x, v, time, law), a = dem__add(dem__free_fall(w), first);
    const dem_vec there = dem__plus(x, probe, dem__plus(v, 0.5 * probe, a));
    const dem_vec soon = dem__field_pull(w, i, there, dem__plus(v, probe, a), time + probe, law);
    const double jerk = dem__length(dem__sub(soon, first)) / probe;
    const double far = dem__time_to_cover(def->length, dem__length(v), dem__length(a));
    double longest = far < def->interval ? far : def->interval;
    if (jerk > 0.0) {
        const double guess = riddle_cbrt(13.5 * 3.0 * limit / jerk);
        longest = guess < longest ? guess : longest;
    }
    int n = dem__steps_within(w, longest);
    for (;;) {
        const double h = (double)n * dt;
        *q = dem__fly(w, i, x, v, time, h, law);
        const double bent = dem__length(dem__sub(dem__scale(2.0 / h, q->way), a)) * h * h / 13.5;
        const double error = bent > 100.0 * q->error ? bent : 100.0 * q->error; /* errors of the ends add up */
        if (n == 1 || error <= limit) return n;
        const double part = 0.9 * riddle_cbrt(limit / error);
        const int fewer = (int)((part > 0.1 ? part : 0.1) * (double)n); /* NaN: a tenth */
        n = fewer > 1 ? fewer : 1;
    }
}

/* Begins a flight now. Where the law gives 0 and gave 0 before, the present parabola stays. */
DEM_INLINE void dem__find_flight(dem_world *w, ptrdiff_t i, dem_vec (*law)(const dem_force_point *)) {
    dem__field *field = &w->engine->field;
    dem_particle *p = &w->particle[i];
    const double tau = dem__now(w, i), dt = w->engine->run.dt;
    const dem_vec x = dem__at(w, i, tau), v = field->until[i] == w->step ? field->end_velocity[i] : dem__velocity_at(w, i, tau);
    const dem_vec g = dem__free_fall(w);
    dem__flown q;
    const int n = dem__choose_flight(w, i, x, v, &q, law);
    const double h = (double)n * dt;
    field->until[i] = w->step + n;
    field->work[i] = q.work, field->booked[i] = 0.0;
    if (!(q.zero && p->a.x == g.x && p->a.y == g.y && p->a.z == g.z)) {
        p->spin = dem__spin_at(w, i, tau);
        p->x = x, p->v = v;
        p->a = q.zero ? g : dem__scale(2.0 / h, q.way);
        p->origin = w->step;
    }
    field->end_velocity[i] = q.zero ? dem__velocity_at(w, i, (double)(w->step + n - p->origin) * dt) : dem__add(v, q.gain);
}

/* Returns whether the flight of particle i is what the law gives from its origin; where that is 0, whether it stays 0 to the end. Then
   computes the velocity at its end and the work. */
DEM_INLINE int dem__is_flight(dem_world *w, ptrdiff_t i, dem_vec (*law)(const dem_force_point *)) {
    dem__field *field = &w->engine->field;
    const dem_particle *p = &w->particle[i];
    const int64_t end = field->until[i], last = w->step + DEM__STEPS_MAX;
    const dem_vec g = dem__free_fall(w);
    const double dt = w->engine->run.dt, tau = dem__now(w, i);
    if (!(end > w->step && end < last && p->origin <= w->step && end - p->origin < 2 * (int64_t)last)) return 0;
    const int zero = p->a.x == g.x && p->a.y == g.y && p->a.z == g.z;
    const double h = (double)(end - (zero ? w->step : p->origin)) * dt;
    const dem_vec v = zero ? dem__velocity_at(w, i, tau) : p->v;
    const dem__flown q = dem__fly(w, i, zero ? dem__at(w, i, tau) : p->x, v, zero ? w->time : dem__time_of(w, p->origin), h, law);
    const dem_vec a = dem__scale(2.0 / h, q.way);
    if (zero != q.zero || (zero && h * dem__length(v) > 2.0 * field->def.length)) return 0;
    if (!zero && !(a.x == p->a.x && a.y == p->a.y && a.z == p->a.z)) return 0;
    field->end_velocity[i] = zero ? dem__velocity_at(w, i, (double)(end - p->origin) * dt) : dem__add(v, q.gain);
    field->work[i] = q.work;
    return 1;
}

/* Ends the flight of particle i now. Its position is that on the parabola; its velocity is computed anew. */
DEM_INLINE void dem__end_flight(dem_world *w, ptrdiff_t i, dem_vec (*law)(const dem_force_point *)) {
    dem__field *field = &w->engine->field;
    dem_particle *p = &w->particle[i];
    const dem_vec g = dem__free_fall(w);
    const double tau = dem__now(w, i);
    const dem_vec x = dem__at(w, i, tau);
    dem_vec v = dem__velocity_at(w, i, tau);
    const int falls = p->a.x == g.x && p->a.y == g.y && p->a.z == g.z;
    field->work[i] = 0.0;
    if (tau > 0.0 && !falls) {
        const dem__flown q = dem__fly(w, i, p->x, p->v, dem__time_of(w, p->origin), tau, law);
        v = dem__add(p->v, q.gain);
        field->work[i] = q.work;
    }
    const dem_vec pull = dem__field_pull(w, i, x, v, w->time, law);
    field->force[i] = dem__scale(p->mass, pull);
    field->until[i] = DEM__NO_FLIGHT;
    if (falls && dem__is_zero(pull)) return; /* the same bits as without a field */
    p->x = x, p->v = v, p->spin = dem__spin_at(w, i, tau);
    p->origin = w->step;
    dem__free_acceleration(w, i);
    p->a = dem__add(p->a, pull);
}

/* Adds the law's force on particle i, which takes steps, at its position after a step of h and at the velocity predicted for it. */
DEM_INLINE void dem__add_field_force(dem_world *w, ptrdiff_t i, double h, dem_vec (*law)(const dem_force_point *)) {
    const dem_particle *p = &w->particle[i];
    const dem_vec pull = dem__field_pull(w, i, p->x, dem__plus(p->v, 0.5 * h, p->a), dem__time_of(w, w->step + (h > 0.0)), law);
    const dem_vec force = dem__scale(p->mass, pull);
    double *load = w->engine->bodies.sum[i].load;
    load[0] += force.x, load[1] += force.y, load[2] += force.z;
    w->engine->field.force[i] = force;
}

DEM_INLINE void dem__field_kernel(dem_world *w, const dem__field_task *q, dem_vec (*law)(const dem_force_point *)) {
    for (ptrdiff_t k = 0; k < q->n; k++) {
        const ptrdiff_t i = q->particle[k];
        if (q->task == DEM__ADD_FIELD_FORCE) dem__add_field_force(w, i, q->h, law);
        else if (q->task == DEM__END_FLIGHTS) dem__end_flight(w, i, law);
        else if (q->task == DEM__FIND_FLIGHTS || !dem__is_flight(w, i, law)) dem__find_flight(w, i, law);
    }
}

/* Runs a task of the kernel for a part of a list of particles. */
static inline void dem__run_field_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    dem__field_task q = *(const dem__field_task *)context;
    (void)part;
    q.particle += first, q.n = end - first;
    w->engine->field.def.kernel(w, &q);
}
/* Runs a task of the kernel for a list of particles, on one thread or several. */
static inline void dem__run_field(dem_world *w, const int32_t *particle, ptrdiff_t n, int task, double h) {
    dem__field_task q;
    memset(&q, 0, sizeof q);
    q.particle = particle, q.n = n, q.task = task, q.h = h;
    dem__in_parts(w, dem__parts(w, 4 * n), n, dem__run_field_range, &q);
}

/* Returns the work of the field along a flight until now [J]: the energy that the particle has gained since its origin. */
static inline double dem__flight_gain(const dem_world *w, ptrdiff_t i) {
    const dem_particle *p = &w->particle[i];
    const double tau = dem__now(w, i);
    const dem_vec v = dem__velocity_at(w, i, tau), way = dem__sub(dem__at(w, i, tau), p->x), g = dem__free_fall(w);
    const double gain = 0.5 * (dem__dot(v, v) - dem__dot(p->v, p->v)) - dem__dot(g, way);
    return p->a.x == g.x && p->a.y == g.y && p->a.z == g.z ? 0.0 : p->mass * gain;
}

DEM_INLINE int dem__is_flying(const dem_world *w, ptrdiff_t i) { return w->alive[i] > 0 && w->engine->bodies.activity[i] == DEM__FLYING; }

/* Takes the work of the field on all flights until now as booked: the ledger begins, or flights are known anew. */
static inline void dem__begin_books(dem_world *w) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (dem__is_flying(w, i)) w->engine->field.booked[i] = dem__flight_gain(w, i);
    }
}

/* Books the work of the field on all flights until now, or only on those of particles that leave. */
static inline void dem__book_flights(dem_world *w, int leaving) {
    dem__field *field = &w->engine->field;
    for (ptrdiff_t i = 0; i < w->count && w->engine->ledger.on; i++) {
        if ((leaving ? w->alive[i] != DEM_LEAVING : w->alive[i] <= 0) || field->until[i] == DEM__NO_FLIGHT) continue;
        const double gain = dem__flight_gain(w, i);
        dem__book_field_work(w, gain - field->booked[i]);
        field->booked[i] = gain;
    }
}

/* Returns how far the velocity of particle i in flight can be from that of its bound until the end of the flight [m/s]. */
DEM_INLINE double dem__flight_deviation(const dem_world *w, ptrdiff_t i) {
    const dem__field *field = &w->engine->field;
    const dem__bound *c = &w->engine->bodies.bound[i];
    const double t = dem__since_listed(w, w->step), left = (double)(field->until[i] - w->step) * w->engine->run.dt;
    const dem_vec g = dem__free_fall(w), u = dem_vec3(c->ux, c->uy, c->uz);
    const dem_vec now = dem__sub(dem__plus(dem__velocity_at(w, i, dem__now(w, i)), -t, g), u);
    const double here = dem__length(now), there = dem__length(dem__plus(now, left, dem__sub(w->particle[i].a, g))),
                 end = dem__length(dem__sub(dem__plus(field->end_velocity[i], -(t + left), g), u));
    const double most = here > there ? here : there;
    return most > end ? most : end;
}

/* Sets a bound for particle i in flight, which holds for about DEM__FLIGHTS flights like this one. */
static inline void dem__bound_flight(dem_world *w, ptrdiff_t i) {
    const dem__field *field = &w->engine->field;
    const dem__pairs *pairs = &w->engine->pairs;
    const double t = dem__since_listed(w, w->step), tau = dem__now(w, i), dt = w->engine->run.dt;
    const double left = (double)(field->until[i] - w->step) * dt;
    const dem_vec g = dem__free_fall(w), x = dem__at(w, i, tau), v = dem__velocity_at(w, i, tau);
    const dem_vec turn = dem__scale(0.5 * DEM__FLIGHTS * left, dem__sub(w->particle[i].a, g)), u = dem__add(v, turn);
    dem__bound *c = &w->engine->bodies.bound[i];
    c->ux = u.x - t * g.x, c->uy = u.y - t * g.y, c->uz = u.z - t * g.z;
    c->x = x.x - t * (u.x - 0.5 * t * g.x), c->y = x.y - t * (u.y - 0.5 * t * g.y), c->z = x.z - t * (u.z - 0.5 * t * g.z);
    const double turned = 1.1 * dem__length(turn), most = 1.1 * dem__flight_deviation(w, i);
    c->tolerance = 0.001 * pairs->least_tolerance + (turned > most ? turned : most);
    c->reach = w->particle[i].radius + pairs->position_tolerance - t * c->tolerance;
    w->engine->bodies.shifted[i] = 0.0;
}

/* Sets the timers of n flights that have just been computed, and new bounds for those that leave theirs. Returns 0 if one is too fast. */
static inline int dem__follow_flights(dem_world *w, const int32_t *list, ptrdiff_t n) {
    dem__field *field = &w->engine->field;
    dem__bodies *bodies = &w->engine->bodies;
    const dem__list_frame frame = dem__frame_at(w, w->step);
    dem__outcome news = dem__no_outcome(w);
    ptrdiff_t reset = 0;
    for (ptrdiff_t k = 0; k < n; k++) {
        const int32_t i = list[k];
        if (w->engine->run.has_periodic && w->particle[i].origin == w->step) dem__wrap(w, i);
        dem__set_timer(&field->timers, i, field->until[i]);
        if (dem__flight_deviation(w, i) < bodies->bound[i].tolerance) continue; /* false for NaN */
        const double shifted = bodies->shifted[i], tau = dem__now(w, i);
        dem__bound_flight(w, i);
        w->engine->scratch.index[reset++] = i;
        if (dem__apply_bound(w, i, w->step, &frame, dem__at(w, i, tau), dem__velocity_at(w, i, tau), shifted, &news))
            dem__advance_wall_timers(w, i, w->step);
    }
    dem__apply_outcome(w, &news);
    dem__reset_pair_timers(w, w->engine->scratch.index, reset, w->step);
    return w->status == DEM_OK;
}

/* Returns whether particle i, which takes steps, has the acceleration without contacts and without the field. */
static inline int dem__feels_no_field(const dem_world *w, ptrdiff_t i) {
    const dem_vec a = dem__plus(dem__free_fall(w), w->engine->bodies.sum[i].per_mass, dem__first(w->engine->bodies.load[i]));
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

/* Prepares a run: begins anew the flights that the caller has changed, and those of new particles. Returns 0 after a failure. */
static inline int dem__prepare_flights(dem_world *w) {
    dem__field *field = &w->engine->field;
    ptrdiff_t n = 0, ended = 0;
    if (!dem__grow_timers(w, &field->timers, w->count, &field->stepping, sizeof *field->stepping)) {
        w->status = DEM_OUT_OF_MEMORY;
        return 0;
    }
    for (int32_t i = 0; i < (int32_t)w->count; i++) {
        field->timers.list[n] = field->stepping[ended] = i;
        n += dem__is_flying(w, i);
        ended += w->alive[i] > 0 && !dem__is_flying(w, i) && (field->until[i] != DEM__NO_FLIGHT || dem__feels_no_field(w, i));
        if (w->alive[i] <= 0 || field->until[i] <= w->step) field->until[i] = DEM__NO_FLIGHT;
    }
    dem__run_field(w, field->stepping, ended, DEM__END_FLIGHTS, 0.0);
    dem__run_field(w, field->timers.list, n, DEM__RENEW_FLIGHTS, 0.0);
    dem__begin_books(w);
    field->steppers = 0;
    return dem__list_flights(w);
}

/* Continues flights that are over by new ones, before a step. Returns 0 after a failure. */
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
        const int32_t c = contacts->slots[k / 2], i = k % 2 ? contacts->j[c] : contacts->i[c];
        if (i < 0 || field->until[i] == DEM__NO_FLIGHT) continue;
        const double booked = field->booked[i];
        dem__run_field(w, &i, 1, DEM__END_FLIGHTS, 0.0);
        dem__book_field_work(w, field->work[i] - booked);
        dem__set_tolerance_left(w, i, dem__length(dem__deviation(w, i, t)));
        dem__stop_timer(&field->timers, i);
    }
}

/* Adds the field's forces on the particles that take steps, at the end of a step, and lists these particles. Books the work by the mean of
   the forces at both ends. */
static inline void dem__add_field_forces(dem_world *w, double h) {
    dem__field *field = &w->engine->field;
    const dem__bodies *bodies = &w->engine->bodies;
    const ptrdiff_t n = bodies->active_count;
    if (n > 0) memcpy(field->stepping, bodies->active, (size_t)n * sizeof *bodies->active);
    field->steppers = n;
    for (ptrdiff_t k = 0; k < n && w->engine->ledger.on && h > 0.0; k++) {
        const ptrdiff_t i = bodies->active[k];
        dem__book_field_work(w, 0.5 * h * dem__dot(field->force[i], w->particle[i].v));
    }
    dem__run_field(w, bodies->active, n, DEM__ADD_FIELD_FORCE, h);
    for (ptrdiff_t k = 0; k < n && w->engine->ledger.on && h > 0.0; k++) {
        const ptrdiff_t i = bodies->active[k];
        dem__book_field_work(w, 0.5 * h * dem__dot(field->force[i], w->particle[i].v));
    }
}

/* Begins flights of particles whose last contact is over, after a step. Returns 0 after a failure. */
static inline int dem__begin_flights(dem_world *w) {
    dem__field *field = &w->engine->field;
    int32_t *list = field->stepping;
    ptrdiff_t n = 0;
    for (ptrdiff_t k = 0; k < field->steppers; k++) {
        const int32_t i = list[k];
        if (dem__is_flying(w, i)) list[n++] = i;
        else if (w->alive[i] > 0 && w->touching[i] == 0 && dem__feels_no_field(w, i)) /* it has a load, and its contact has ended */
            w->particle[i].a = dem__plus(w->particle[i].a, w->engine->bodies.sum[i].per_mass, field->force[i]);
    }
    field->steppers = 0;
    if (n == 0) return 1;
    dem__run_field(w, list, n, DEM__FIND_FLIGHTS, 0.0);
    return dem__follow_flights(w, list, n);
}

DEM_API dem_force_field dem_default_force_field(dem_field_fn kernel, const void *user) {
    dem_force_field field;
    field.kernel = kernel;
    field.user = user;
    field.length = field.interval = HUGE_VAL;
    field.accuracy = 1e-6;
    return field;
}

/* Removes the field: particles in flight fall freely from now on. */
static inline void dem__drop_field(dem_world *w) {
    dem__field *field = &w->engine->field;
    for (ptrdiff_t i = 0; i < w->count && field->on; i++) {
        if (!dem__is_flying(w, i)) continue;
        dem__restart(w, i);
        dem__free_acceleration(w, i);
    }
    dem__release(&w->def.allocator, field->timers.block, field->timers.bytes);
    memset(field, 0, sizeof *field);
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
}

DEM_API dem_status dem_set_force_field(dem_world *world, const dem_force_field *field) {
    dem_world *w = world;
    dem__array list[DEM__ARRAYS_MAX];
    if (dem__is_running(w)) return DEM_BUSY;
    if (!w || !w->def.allocator.fn) return DEM_BAD_ARGUMENT;
    if (!field) {
        dem__drop_field(w);
        return DEM_OK;
    }
    const int was_loaded = w->engine->field.on && !w->engine->field.def.kernel;
    if (!field->kernel || !(field->length > 0.0) || !(field->interval > 0.0) || !(field->accuracy >= 1e-12 && field->accuracy <= 1e-4) ||
        w->engine->links.on || (dem__bodies_present(w) > 0 && !was_loaded))
        return DEM_BAD_ARGUMENT;
    if (!w->engine->field.on) {
        w->engine->field.on = 1;
        if (w->engine->bodies.capacity > 0 &&
            !dem__grow_group(w, list, dem__particle_arrays(w, list), &w->engine->bodies.block, &w->engine->bodies.bytes,
                             &w->engine->bodies.capacity, w->engine->bodies.capacity)) {
            w->engine->field.on = 0;
            return DEM_OUT_OF_MEMORY;
        }
    }
    if (!was_loaded) w->engine->run.needs_forces = 1; /* otherwise the accelerations are those of the field already */
    w->engine->field.def = *field;
    w->engine->run.needs_lists = 1;
    return DEM_OK;
}
