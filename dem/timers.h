/* ------------------------------------------------------------------------------------------------- >>lists */

/* So many parts are n pieces of work shared in: one, or one a thread if each is worth starting it. One part begins no parallel region, for
   that would cost more than the work of a dilute step. */
DEM_INLINE int dem__parts(const dem_world *w, ptrdiff_t n) {
#ifdef _OPENMP
    return w->def.threads == 1 || n < 256 * (ptrdiff_t)w->def.threads ? 1
           : w->def.threads < DEM__PARTS_MAX                          ? w->def.threads
                                                                      : DEM__PARTS_MAX;
#else
    (void)w, (void)n;
    return 1;
#endif
}
DEM_INLINE ptrdiff_t dem__part(ptrdiff_t n, int part, int parts) { return n / parts * part + (n % parts < part ? n % parts : part); }

/* The same if there are only `most` things to share. */
DEM_INLINE int dem__parts_of(const dem_world *w, ptrdiff_t n, int most) {
    const int parts = dem__parts(w, n);
    return parts < most ? parts : most;
}

/* A timer is of a near pair, or of a particle and a wall. A look finds a contact, or the next time when one is possible. */

DEM_INLINE void dem__set_due(dem__timers *t, int32_t e, int32_t due) {
    int32_t *earliest = &t->earliest[(uint32_t)e / DEM__BUNCH];
    t->due[e] = due;
    *earliest = due < *earliest ? due : *earliest;
}
DEM_INLINE void dem__set_timer(dem__timers *t, int32_t e, int64_t step) { dem__set_due(t, e, (int32_t)(step - t->from)); }
DEM_INLINE void dem__stop_timer(dem__timers *t, int32_t e) { t->due[e] = DEM__STOPPED; }

DEM_INLINE int32_t dem__earliest(const int32_t *due) {
    int32_t earliest = DEM__STOPPED;
    DEM__ROLLED
    for (int k = 0; k < DEM__BUNCH; k++) earliest = due[k] < earliest ? due[k] : earliest;
    return earliest;
}

/* Those of bunch b that are due go to the end of a list of n, and are set to `then`; how many are listed. */
DEM_INLINE ptrdiff_t dem__open_bunch(dem__timers *t, ptrdiff_t b, int32_t now, int32_t then, int32_t *list, ptrdiff_t n) {
    int32_t *due = t->due + b * DEM__BUNCH;
    t->earliest[b] = dem__earliest(due);
    if (t->earliest[b] > now) return n; /* those it was have been set anew */
    for (int k = 0; k < DEM__BUNCH; k++) {
        list[n] = (int32_t)(b * DEM__BUNCH) + k;
        n += due[k] <= now;
    }
    DEM__ROLLED
    for (int k = 0; k < DEM__BUNCH; k++) due[k] = due[k] <= now ? then : due[k];
    t->earliest[b] = dem__earliest(due);
    return n;
}

/* Lists the timers in sheaves first .. end-1 that are due at a step, from list[first * DEM__SHEAF] on, and sets them to `then`; how
   many. */
DEM_INLINE ptrdiff_t dem__find_due(dem__timers *t, ptrdiff_t first, ptrdiff_t end, int64_t step, int32_t then) {
    const int32_t now = (int32_t)(step - t->from);
    int32_t *list = t->list + first * DEM__SHEAF;
    ptrdiff_t n = 0;
    int32_t open[4 * DEM__BUNCH];
    int opened = 0;
    for (ptrdiff_t s = first; s < end; s++) {
        const int32_t *earliest = &t->earliest[s * DEM__BUNCH];
        int any = 0;
        DEM__ROLLED
        for (int k = 0; k < DEM__BUNCH; k++) any |= earliest[k] <= now;
        const int before = opened;
        for (int k = 0; k < DEM__BUNCH && any; k++) { /* without a branch, which nobody could predict */
            open[opened] = (int32_t)(s * DEM__BUNCH) + k;
            opened += earliest[k] <= now;
        }
        for (int k = before; k < opened; k++) DEM__PREFETCH(&t->due[open[k] * DEM__BUNCH]);
        if (opened <= 3 * DEM__BUNCH && s + 1 < end) continue;
        for (int k = 0; k < opened; k++) n = dem__open_bunch(t, open[k], now, then, list, n);
        opened = 0;
    }
    return n;
}
DEM__TWICE(dem__list_due, (dem__timers * t, ptrdiff_t first, ptrdiff_t end, int64_t step, int32_t then, ptrdiff_t *n),
           (t, first, end, step, then, n), *n = dem__find_due(t, first, end, step, then))

/* From a step on: until the timer is due, and for how long nothing can happen at a wall, which may be longer. */
DEM_INLINE int dem__steps_due(const dem__timers *t, int32_t e, int64_t step) { return (int)(t->due[e] - (step - t->from)); }
DEM_INLINE int dem__steps_sure(const dem_world *w, int32_t e, int64_t step) {
    return (int)(int32_t)(w->wall_sure__[e] - (uint32_t)(uint64_t)step);
}

/* Steps until t [s], at least one, at most DEM__FAR - 1: no contact can happen before. */
DEM_INLINE int dem__steps_until(const dem_world *w, double t) {
    double n = t * w->pace__;
    return n < (double)(DEM__FAR - 2) ? 1 + (int)n : DEM__FAR - 1;
}

/* Time in which something at speed s, falling besides with g, covers a distance. */
DEM_INLINE double dem__time_to_cover(double distance, double s, double g) {
    return distance > 0.0 ? 2.0 * distance / (s + sqrt(s * s + 2.0 * g * distance)) : 0.0;
}

/* Time in which something covers a distance that approaches at u (< 0: recedes) and accelerates by at most a. */
DEM_INLINE double dem__time_to_close(double distance, double u, double a) {
    const double root = u + sqrt(u * u + 2.0 * a * distance);
    return distance > 0.0 ? (root > 0.0 ? 2.0 * distance / root : HUGE_VAL) : 0.0;
}

/* From the centre of j to that of i, at a step. */
DEM_INLINE dem_vec dem__pair_apart(const dem_world *w, ptrdiff_t i, ptrdiff_t j, int64_t step) {
    return dem__apart(w, dem__sub(dem__at(w, i, (double)(step - w->particle[i].origin) * w->dt__),
                                  dem__at(w, j, (double)(step - w->particle[j].origin) * w->dt__)));
}

typedef double dem__row[DEM_BLOCK];

/* Pairs whose timers are to be set; and what looks have found. */
typedef struct dem__waits {
    dem__course apart[DEM_BLOCK]; /* of one relative to the other: they touch within `off` */
    int32_t pair[DEM_BLOCK], steps[DEM_BLOCK];
    int n;
    int32_t *found; /* of a look: pairs that touch */
    ptrdiff_t touch;
    int64_t looks;
} dem__waits;

DEM_INLINE void dem__no_waits(dem__waits *q) { q->n = 0, q->found = NULL, q->touch = 0, q->looks = 0; }

/* Steps until spheres can touch that stray so far from their courses: 0 for never, else at least one, at most DEM__FAR - 1. */
DEM_INLINE void dem__wait_steps(dem__waits *q, double pace) {
    for (int k = 0; k < q->n; k++) {
        const dem__course *r = &q->apart[k];
        const double a = r->ux * r->ux + r->uy * r->uy + r->uz * r->uz - r->ball * r->ball;
        const double b = r->x * r->ux + r->y * r->uy + r->z * r->uz - r->off * r->ball;
        const double c = r->x * r->x + r->y * r->y + r->z * r->z - r->off * r->off;
        const double root = b * b - a * c, below = sqrt(root > 0.0 ? root : 0.0) - b;
        const double n = c / (below > 0.0 ? below : 1.0) * pace, turns = n < (double)(DEM__FAR - 2) ? n : (double)(DEM__FAR - 2);
        const double steps = ((root > 0.0) & (below > 0.0)) ? 1.0 + turns : 0.0;
        q->steps[k] = (int32_t)(c > 0.0 ? steps : 1.0);
    }
}
DEM__TWICE(dem__find_steps, (dem__waits * q, double pace), (q, pace), dem__wait_steps(q, pace))

static inline void dem__set_waits(dem_world *w, dem__waits *q, int64_t step) {
    const int32_t now = (int32_t)(step - w->pair_timers__.from);
    dem__find_steps(q, w->pace__);
    for (int k = 0; k < q->n; k++) dem__set_due(&w->pair_timers__, q->pair[k], q->steps[k] > 0 ? now + q->steps[k] : DEM__NEVER);
    q->n = 0;
}

/* Time on the courses [s]. */
DEM_INLINE double dem__since_listed(const dem_world *w, int64_t step) { return (double)(step - w->listed__) * w->dt__; }

/* Where a course has led by t [s]. */
DEM_INLINE dem__course dem__course_at(const dem__course *c, double t) {
    dem__course now = *c;
    now.x += t * c->ux, now.y += t * c->uy, now.z += t * c->uz, now.off += t * c->ball;
    return now;
}

/* A place for pair p and two courses, one relative to the other. */
DEM_INLINE dem__course *dem__wait_for_pair(dem_world *w, dem__waits *q, int32_t p, int64_t step, const dem__course *a,
                                           const dem__course *b) {
    if (q->n == DEM_BLOCK) dem__set_waits(w, q, step);
    dem__course *r = &q->apart[q->n];
    q->pair[q->n++] = p;
    r->x = a->x - b->x, r->y = a->y - b->y, r->z = a->z - b->z, r->off = a->off + b->off;
    r->ux = a->ux - b->ux, r->uy = a->uy - b->uy, r->uz = a->uz - b->uz, r->ball = a->ball + b->ball;
    return r;
}

/* Pair p, linked or not, by where its courses have led at a step. */
DEM_INLINE void dem__wait_on_courses(dem_world *w, dem__waits *q, int32_t p, int64_t step, const dem__course *a, const dem__course *b) {
    dem__course *r = dem__wait_for_pair(w, q, p, step, a, b);
    if (!w->has_periodic__) return;
    const dem_vec d = dem__apart(w, dem_vec3(r->x, r->y, r->z));
    r->x = d.x, r->y = d.y, r->z = d.z;
}

/* Pair p, whose centres are known to be d apart at a step. */
DEM_INLINE void dem__wait_from(dem_world *w, dem__waits *q, int32_t p, int64_t step, dem_vec d) {
    const dem__near *pair = &w->near__[p];
    dem__course *r = dem__wait_for_pair(w, q, p, step, &w->course__[pair->i], &w->course__[pair->j]);
    r->x = d.x, r->y = d.y, r->z = d.z, r->off = pair->distance + 2.0 * w->blur__;
}
