/* ------------------------------------------------------------------------------------------ >>parallel */
/* The loops of a step over several threads. Relies on: nothing but the definition. Promises: no result depends on how many there are.
   May be changed here alone: who runs a task. */

/* Runs task(context, index) for every index below tasks: on the host's threads, on those of OpenMP, or one after the other. */
static inline void dem__parallel(const dem_def *def, int tasks, void (*task)(void *context, int index), void *context) {
    int q;
    if (tasks == 1) task(context, 0); /* a parallel region would cost more than the work of a dilute step */
    else if (def->parallel) def->parallel(def->parallel_user, tasks, task, context);
    else {
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(tasks)
#endif
        for (q = 0; q < tasks; q++) task(context, q);
    }
}

/* Number of parts to split n items into: one per thread, or 1 if a part would be too small to pay for waking a thread. */
DEM_INLINE int dem__parts(const dem_world *w, ptrdiff_t n) {
    const int threads = w->def.threads < DEM__PARTS_MAX ? w->def.threads : DEM__PARTS_MAX;
#ifndef _OPENMP
    if (!w->def.parallel) return 1;
#endif
    return threads == 1 || n < 256 * (ptrdiff_t)threads ? 1 : threads;
}

/* The same with at most `most` parts. */
DEM_INLINE int dem__parts_of(const dem_world *w, ptrdiff_t n, int most) {
    const int parts = dem__parts(w, n);
    return parts < most ? parts : most;
}

/* The first of n items that belongs to a part. */
DEM_INLINE ptrdiff_t dem__part(ptrdiff_t n, int part, int parts) { return n / parts * part + (n % parts < part ? n % parts : part); }

/* A loop over items first .. end - 1, which are part `part` of n, with what the loop needs. */
typedef void dem__range_fn(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context);
typedef struct dem__split {
    dem_world *w;
    dem__range_fn *loop;
    void *context;
    ptrdiff_t n;
    int parts;
} dem__split;

static inline void dem__run_part(void *context, int q) {
    const dem__split *s = (const dem__split *)context;
    s->loop(s->w, dem__part(s->n, q, s->parts), dem__part(s->n, q + 1, s->parts), q, s->context);
}

/* Runs a loop over n items in so many parts. */
static inline void dem__in_parts(dem_world *w, int parts, ptrdiff_t n, dem__range_fn *loop, void *context) {
    dem__split split;
    split.w = w;
    split.loop = loop;
    split.context = context;
    split.n = n;
    split.parts = parts;
    dem__parallel(&w->def, parts, dem__run_part, &split);
}
