/* The loops of a step on several threads. Promises: no result depends on the number of threads. */
#pragma once
#include "engine.h"

/* Runs the tasks of a loop one after the other. */
static inline void dem__run_alone(int tasks, void (*task)(void *context, int index), void *context) {
    for (int q = 0; q < tasks; q++) task(context, q);
}

#ifdef _OPENMP
/* Decides whether loops run on one thread. If another program occupies a core, threads wait for each other longer than
   the work takes. Compares the duration of a loop, from start to end [s], with the sum of its tasks' times. A task that
   was interrupted counts as at most three times the first, which the waiting thread ran itself. After a loss of 2 ms,
   loops run on one thread for 20 ms, and twice as long each time that threads soon lose again. */
static inline void dem__judge_threads(dem__pace *pace, double start, double end, const double *spent, int tasks) {
    double alone = 0.0;
    for (int q = 0; q < tasks; q++) alone += spent[q] < 3.0 * spent[0] ? spent[q] : 3.0 * spent[0];
    pace->loss += end - start - alone;
    if (!(pace->loss > 0.0)) pace->loss = 0.0;
    if (!(pace->loss > 2e-3)) return;
    pace->rest = end > pace->alone_until + 5.0 * pace->rest ? 0.02 : 2.0 * pace->rest;
    if (pace->rest > 2.0) pace->rest = 2.0;
    pace->alone_until = end + pace->rest;
    pace->loss = 0.0;
}

/* Runs the tasks of a loop on OpenMP's threads, or on one while these lose time. */
static inline void dem__run_openmp(dem__pace *pace, int tasks, void (*task)(void *context, int index), void *context) {
    const double start = omp_get_wtime();
    double spent[DEM__PARTS_MAX];
    int q;
    if (start < pace->alone_until) {
        dem__run_alone(tasks, task, context);
        return;
    }
#pragma omp parallel for schedule(static, 1) num_threads(tasks)
    for (q = 0; q < tasks; q++) {
        const double began = omp_get_wtime();
        task(context, q);
        spent[q] = omp_get_wtime() - began;
    }
    dem__judge_threads(pace, start, omp_get_wtime(), spent, tasks);
}
#endif

/* Runs task(context, index) for every index below `tasks`: on the host's threads, on OpenMP's, or one after the other.
 */
static inline void dem__parallel(dem_world *w, int tasks, void (*task)(void *context, int index), void *context) {
    if (tasks == 1) task(context, 0); /* a parallel region would cost more than the work of a dilute step */
    else if (w->def.parallel) w->def.parallel(w->def.parallel_user, tasks, task, context);
    else {
#ifdef _OPENMP
        dem__run_openmp(&w->engine->pace, tasks, task, context);
#else
        dem__run_alone(tasks, task, context);
#endif
    }
}

/* Returns the number of threads that a run may use. More OpenMP threads than processors would wait for each other; a
   host knows what its threads are. */
static inline int dem__usable_threads(const dem_world *w) {
    int threads = w->def.threads < DEM__PARTS_MAX ? w->def.threads : DEM__PARTS_MAX;
    if (w->def.parallel) return threads;
#ifdef _OPENMP
    return threads < omp_get_num_procs() ? threads : omp_get_num_procs();
#else
    return 1;
#endif
}

/* Returns into how many parts to split n items: as many as there are threads, or as pay for waking them. */
DEM_INLINE int dem__parts(const dem_world *w, ptrdiff_t n) {
    const int threads = w->engine->scratch.threads;
    if (threads <= 1 || n < 2 * DEM__SHARE) return 1;
    return n < DEM__SHARE * (ptrdiff_t)threads ? (int)(n / DEM__SHARE) : threads;
}

/* Returns the same, but at most `most`. */
DEM_INLINE int dem__parts_of(const dem_world *w, ptrdiff_t n, int most) {
    const int parts = dem__parts(w, n);
    return parts < most ? parts : most;
}

/* Returns the first of n items that belongs to a part. */
DEM_INLINE ptrdiff_t dem__part(ptrdiff_t n, int part, int parts) {
    return n / parts * part + (n % parts < part ? n % parts : part);
}

/* Returns where a loop over n entries begins that prefetches `ahead` entries before it uses them. A few entries need no
   long lead. */
DEM_INLINE ptrdiff_t dem__prefetch_from(ptrdiff_t n, ptrdiff_t ahead) { return n < ahead ? -n : -ahead; }

/* Runs a loop over the items first .. end - 1 of part `part`. context: what the loop needs. */
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

/* Runs a loop over n items in `parts` parts. */
static inline void dem__in_parts(dem_world *w, int parts, ptrdiff_t n, dem__range_fn *loop, void *context) {
    dem__split split;
    if (parts == 1) { /* saves the divisions of dem__part */
        loop(w, 0, n, 0, context);
        return;
    }
    split.w = w;
    split.loop = loop;
    split.context = context;
    split.n = n;
    split.parts = parts;
    dem__parallel(w, parts, dem__run_part, &split);
}
