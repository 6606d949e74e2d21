/* How far links change the velocity of particle i until they are evaluated again, at most [m/s]. */
DEM_INLINE double dem__link_drift(const dem_world *w, ptrdiff_t i) {
    return (double)w->link_stride__ * w->dt__ / w->particle[i].mass * dem__length(dem__first(w->load__[i]));
}

/* At most so far does a pull turn it from its course in a step [m/s]: the sum of parts costs no root. */
DEM_INLINE double dem__way(double dt, dem_vec pull) { return dt * (fabs(pull.x) + fabs(pull.y) + fabs(pull.z)); }

/* Of a particle that has strayed so far from its course: what its ball leaves it beyond this step. */
DEM_INLINE void dem__leave_room(dem_world *w, ptrdiff_t i, double strayed) {
    w->particle[i].room__ = w->course__[i].ball - strayed - dem__way(w->dt__, dem__sub(w->particle[i].a, w->def.gravity));
}

/* A new course for particle i, which is at x and has v at a step. An impact that has just begun takes its velocity to one that is about as
   far behind its middle as it is ahead of that now: one course through the middle, with a ball that holds both, lasts to the end. Else the
   ball holds 16 steps of the present force and a little more: in flight very little, as nothing turns it from its course before a contact
   does, and small balls let neighbours alone for long. */
DEM_INLINE void dem__set_course(dem_world *w, ptrdiff_t i, int64_t step, dem_vec x, dem_vec v) {
    const double t = dem__since_listed(w, step);
    const dem_vec g = w->def.gravity, impact = w->touching[i] == 1 ? w->impact__[i] : dem_vec3(0.0, 0.0, 0.0);
    const dem_vec u = dem__add(v, impact);
    const double turn = dem__length(impact), held = 16.0 * w->dt__ * dem__length(dem__sub(w->particle[i].a, g));
    dem__course *c = &w->course__[i];
    c->ux = u.x - t * g.x, c->uy = u.y - t * g.y, c->uz = u.z - t * g.z;
    c->x = x.x - t * (u.x - 0.5 * t * g.x), c->y = x.y - t * (u.y - 0.5 * t * g.y), c->z = x.z - t * (u.z - 0.5 * t * g.z);
    w->shifted__[i] = 0.0;
    if (turn > 0.0) c->ball = 0.25 * w->slack__ + 1.1 * turn + 0.125 * held; /* and the next step for sure */
    else c->ball = (w->touching[i] == 0 ? 0.001 : 1.0) * w->slack__ + held;
    if (w->links_on__ && w->link_head__[i] >= 0) c->ball += 2.0 * dem__link_drift(w, i);
    c->off = w->particle[i].radius + 0.5 * w->link_near__ + w->blur__ - t * c->ball;
    dem__leave_room(w, i, turn);
}

/* What some threads learn from new courses: when the list is to be asked again, and who is too fast (-1: nobody). */
typedef struct dem__news {
    int64_t check;
    ptrdiff_t fast;
} dem__news;
DEM_INLINE dem__news dem__no_news(const dem_world *w) {
    const dem__news news = {w->next_check__, -1};
    return news;
}
static inline void dem__take_news(dem_world *w, const dem__news *news) {
    if (news->check < w->next_check__) w->next_check__ = news->check;
    if (news->fast < 0 || w->status != DEM_OK) return;
    w->status = DEM_TOO_FAST;
    w->failed_id = w->id[news->fast];
}

/* The frame in which the list waits for somebody to move: where it has gone since, and how fast it is. */
typedef struct dem__list_frame {
    dem_vec way, velocity;
} dem__list_frame;
DEM_INLINE dem__list_frame dem__frame_at(const dem_world *w, int64_t step) {
    const double t = dem__since_listed(w, step);
    dem__list_frame f;
    f.way = dem__scale(t, dem__plus(w->list_velocity__, 0.5 * t, w->list_acceleration__));
    f.velocity = dem__plus(w->list_velocity__, t, w->list_acceleration__);
    return f;
}

/* How far a particle at x with v may still move before it could touch somebody who isn't listed, and how fast it does: in that frame. */
typedef struct dem__leeway {
    double left, speed; /* [m], [m/s] */
} dem__leeway;
DEM_INLINE dem__leeway dem__leeway_of(const dem_world *w, ptrdiff_t i, const dem__list_frame *f, dem_vec x, dem_vec v) {
    dem__leeway q;
    q.left = 0.49 * w->margin__ - dem__length(dem__apart(w, dem__sub(x, dem__add(w->listed_at__[i], f->way))));
    q.speed = dem__length(dem__sub(v, f->velocity)) + 2.0 * w->course__[i].ball;
    return q;
}

/* Steps for which that lasts. */
DEM_INLINE int dem__steps_left(const dem_world *w, const dem__leeway *q) {
    return dem__steps_until(w, dem__time_to_cover(q->left, q->speed, w->list_fall__));
}

/* Is it enough for a time [s]? False for NaN. */
DEM_INLINE int dem__lasts(const dem_world *w, const dem__leeway *q, double time) {
    return q->left > time * (q->speed + 0.5 * w->list_fall__ * time);
}

/* What else a new course of particle i has an effect on, which has been shifted from its last one. Is a wall to be looked at sooner? Then
   dem__hurry_to_walls sees to it. */
static inline int dem__heed_course(dem_world *w, ptrdiff_t i, int64_t step, const dem__list_frame *f, dem_vec x, dem_vec v, double shifted,
                                   dem__news *news) {
    const dem__leeway leeway = dem__leeway_of(w, i, f, x, v);
    double speed = dem__length(v);
    int sooner = 0;
    if (!(speed * w->dt__ <= 0.5 * w->particle[i].radius) && news->fast < 0) news->fast = i;
    speed += 2.0 * w->course__[i].ball;
    if (!dem__lasts(w, &leeway, (double)(news->check - step) * w->dt__)) {
        const int64_t due = leeway.left > 0.0 ? step + dem__steps_left(w, &leeway) : step; /* it was put elsewhere: at once */
        if (due < news->check) news->check = due;
    }
    if (!(w->def.skip & DEM_SKIP_SPACE)) return 0;
    double slower = 1.0; /* what was sure at the speed that the timers of walls counted on takes less time now */
    if (speed > w->wall_speed__[i]) {
        slower = w->wall_speed__[i] / (1.25 * speed);
        w->wall_speed__[i] = 1.25 * speed;
    }
    const double lost = shifted > 0.0 ? 1.0 + shifted / (w->wall_speed__[i] * w->dt__) : 0.0; /* as many steps as it would take */
    for (int k = 0; k < w->walls; k++) {
        const int32_t e = (int32_t)i * w->walls + k;
        if (w->wall_timers__.due[e] == DEM__STOPPED) continue;
        const double left = (double)(dem__steps_sure(w, e, step) - 1) * slower - lost;
        const int now = left > 0.0 ? 1 + (int)left : 1;
        w->wall_sure__[e] = (uint32_t)(uint64_t)(step + now); /* the look finds the time */
        sooner |= now < dem__steps_due(&w->wall_timers__, e, step);
    }
    return sooner;
}
static inline void dem__hurry_to_walls(dem_world *w, ptrdiff_t i, int64_t step) {
    for (int k = 0; k < w->walls; k++) {
        const int32_t e = (int32_t)i * w->walls + k;
        const int sure = dem__steps_sure(w, e, step), due = w->wall_timers__.due[e];
        if (due != DEM__STOPPED && sure < dem__steps_due(&w->wall_timers__, e, step)) dem__set_timer(&w->wall_timers__, e, step + sure);
    }
}

/* A new course for particle i, and what else it has an effect on; its pairs are left to dem__restart. By one thread. */
static inline void dem__begin_course(dem_world *w, ptrdiff_t i, int64_t step) {
    const double shifted = w->shifted__[i], tau = (double)(step - w->particle[i].origin) * w->dt__;
    const dem_vec x = dem__at(w, i, tau), v = dem__velocity_at(w, i, tau);
    const dem__list_frame frame = dem__frame_at(w, step);
    dem__news news = dem__no_news(w);
    dem__set_course(w, i, step, x, v);
    if (dem__heed_course(w, i, step, &frame, x, v, shifted, &news)) dem__hurry_to_walls(w, i, step);
    dem__take_news(w, &news);
}

/* All look at wall k at a step. */
static inline void dem__hurry(dem_world *w, int k, int64_t step) {
    for (ptrdiff_t i = 0; i < w->count && (w->def.skip & DEM_SKIP_SPACE); i++) {
        const int32_t e = (int32_t)i * w->walls + k;
        if (w->wall_timers__.due[e] != DEM__STOPPED) dem__set_timer(&w->wall_timers__, e, step);
    }
}

/* Walls to a step. Timers count on a bound of each wall's speed: a driven wall that has just outrun its own gets a larger one, and is
   looked at by all in this very step. */
static inline int dem__move_walls(dem_world *w, int64_t step) {
    const double time = w->start_time__ + (double)(step - w->start_step__) * w->dt__;
    const dem_wall *last = NULL;
    dem__sway sway;
    for (int k = 0; k < w->walls; k++) {
        dem_wall *a = &w->wall[k];
        if (a->drive == DEM_KINEMATIC) {
            if (!(a->speed_bound > 0.0 || a->spin_bound > 0.0)) continue;
            if (!last || !dem__sways_with(a, last)) sway = dem__sway_at(a, time - a->motion_start);
            dem__kinematic_wall(a, time - a->motion_start, &sway);
            last = a;
            continue;
        }
        const dem_vec from = a->position, axis[3] = {a->axis[0], a->axis[1], a->axis[2]};
        double turn = 0.0;
        dem__move_wall(a, time);
        if (!dem__wall_is_finite(a)) return 0;
        const double speed = dem__length(dem__sub(a->position, from)) / w->dt__;
        for (int q = 0; q < 3; q++) { /* at least one axis turns by sqrt(2/3) of the angle */
            const double tip = 1.25 * dem__length(dem__sub(a->axis[q], axis[q])) / w->dt__;
            turn = tip > turn ? tip : turn;
        }
        if (speed <= a->speed_bound && turn <= a->spin_bound) continue;
        a->speed_bound = speed > a->speed_bound ? 1.5 * speed : a->speed_bound;
        a->spin_bound = turn > a->spin_bound ? 1.5 * turn : a->spin_bound;
        dem__hurry(w, k, step);
    }
    return 1;
}

/* Ahead of new timers. */
DEM_INLINE void dem__fetch_neighbours(const dem_world *w, ptrdiff_t i) {
    for (int32_t k = w->adjacent_start__[i]; k < w->adjacent_start__[i + 1]; k++) {
        DEM__PREFETCH(&w->pair_timers__.due[w->adjacent__[2 * k]]);
        DEM__PREFETCH(&w->course__[w->adjacent__[2 * k + 1]]);
    }
}

/* Has particle i pairs from low to high - 1? They are listed in order. */
DEM_INLINE int dem__has_pairs(const dem_world *w, ptrdiff_t i, ptrdiff_t low, ptrdiff_t high) {
    const int32_t begin = w->adjacent_start__[i], stop = w->adjacent_start__[i + 1];
    return begin < stop && w->adjacent__[2 * begin] < high && w->adjacent__[2 * stop - 2] >= low;
}

/* New timers for those pairs of particles with new courses that are in sheaves first .. end-1. */
DEM_INLINE void dem__wait_for_all(dem_world *w, const int32_t *restarted, ptrdiff_t n, ptrdiff_t first, ptrdiff_t end, int64_t step) {
    const ptrdiff_t low = first * DEM__SHEAF, high = end * DEM__SHEAF;
    const double t = dem__since_listed(w, step);
    dem__waits waits;
    dem__no_waits(&waits);
    for (ptrdiff_t m = -16; m < n; m++) {
        /* ahead: where the list of neighbours begins, the list, then what it lists */
        if (m + 16 < n) DEM__PREFETCH(&w->adjacent_start__[restarted[m + 16]]);
        if (m >= -8 && m + 8 < n) {
            const int32_t *list = &w->adjacent__[2 * w->adjacent_start__[restarted[m + 8]]];
            DEM__PREFETCH(list);
            DEM__PREFETCH(list + 16);
        }
        if (m >= -2 && m + 2 < n && dem__has_pairs(w, restarted[m + 2], low, high)) dem__fetch_neighbours(w, restarted[m + 2]);
        if (m < 0 || !dem__has_pairs(w, restarted[m], low, high)) continue;
        const int32_t i = restarted[m], begin = w->adjacent_start__[i], stop = w->adjacent_start__[i + 1];
        const dem__course own = dem__course_at(&w->course__[i], t);
        for (int32_t k = begin; k < stop; k++) {
            const int32_t p = w->adjacent__[2 * k];
            if (p < low || p >= high || w->pair_timers__.due[p] == DEM__STOPPED) continue;
            const dem__course other = dem__course_at(&w->course__[w->adjacent__[2 * k + 1]], t);
            dem__wait_on_courses(w, &waits, p, step, &own, &other);
        }
    }
    dem__set_waits(w, &waits, step);
}
DEM__TWICE(dem__wait_anew, (dem_world * w, const int32_t *restarted, ptrdiff_t n, ptrdiff_t first, ptrdiff_t end, int64_t step),
           (w, restarted, n, first, end, step), dem__wait_for_all(w, restarted, n, first, end, step))

/* New timers for the pairs of the listed particles, which have new courses. */
static inline void dem__restart(dem_world *w, const int32_t *restarted, ptrdiff_t n, int64_t step) {
    const ptrdiff_t sheaves = w->pair_timers__.sheaves;
    const int parts = dem__parts(w, 4 * n);
    int q;
    if (!(w->def.skip & DEM_SKIP_PAIRS)) return;
    if (parts == 1) {
        dem__wait_anew(w, restarted, n, 0, sheaves, step);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
    for (q = 0; q < parts; q++) dem__wait_anew(w, restarted, n, dem__part(sheaves, q, parts), dem__part(sheaves, q + 1, parts), step);
}
