/* What every part of filtration.h uses: status codes, memory, parallel loops. */
#pragma once
#include "compiler.h"

/* ==== >>base ==== */
/* clang-format off */
#define FILTRATION_STATUSES(X)                                                                        \
    X(FILTRATION_OK, "ok")                                                                            \
    X(FILTRATION_BAD_ARGUMENT, "an argument is outside its range")                                    \
    X(FILTRATION_BAD_DEF, "a field of the definition is outside its range")                           \
    X(FILTRATION_NO_MEMORY, "out of memory")                                                          \
    X(FILTRATION_FEW_DATA, "too few data for the number of unknowns")                                 \
    X(FILTRATION_NO_SOLUTION, "no solution in the range allowed")                                     \
    X(FILTRATION_NOT_STEADY, "not steady within the number of steps allowed")                         \
    X(FILTRATION_DIVERGED, "the flow diverged: filtration_fluid.problem tells where and why")         \
    X(FILTRATION_TOO_FAST, "a sphere moves more than half a voxel in one step")                       \
    X(FILTRATION_BAD_DATA, "saved data are damaged, of another version, box or precision")            \
    X(FILTRATION_STREAM, "the host's function refused to write or to read")
#define FILTRATION__ENUM(name, text) name,
typedef enum filtration_status { FILTRATION_STATUSES(FILTRATION__ENUM) FILTRATION_STATUS_COUNT } filtration_status;
/* clang-format on */
FILTRATION_API const char *filtration_status_text(filtration_status status); /* never NULL; static storage */

/* Memory hook: old NULL allocates, new_size 0 frees and returns NULL, otherwise it resizes. fn NULL: malloc, realloc,
   free. */
typedef struct filtration_memory {
    void *(*fn)(void *user, void *old, size_t old_size, size_t new_size);
    void *user;
} filtration_memory;

/* Parallel hook: runs task(context, 0 .. tasks - 1), in any order, on any thread, and returns when all are done. fn
   NULL: OpenMP if the compiler has it, otherwise one after the other. */
typedef struct filtration_parallel {
    void (*fn)(void *user, int tasks, void (*task)(void *context, int index), void *context);
    void *user;
} filtration_parallel;

#ifdef FILTRATION__BODIES
FILTRATION_API const char *filtration_status_text(filtration_status status) {
#define FILTRATION__TEXT(name, text) text,
    static const char *const texts[] = {FILTRATION_STATUSES(FILTRATION__TEXT)};
    return (int)status >= 0 && (int)status < (int)FILTRATION_STATUS_COUNT ? texts[status] : "unknown status";
}
#endif

#define FILTRATION__LARGEST 1.7976931348623157e308
static inline int filtration__is_finite(double x) { return fabs(x) <= FILTRATION__LARGEST; }
static inline int filtration__is_positive(double x) { return x > 0.0 && filtration__is_finite(x); }

static inline void *filtration__resize(const filtration_memory *m, void *old, size_t old_size, size_t new_size) {
    if (m->fn) return m->fn(m->user, old, old_size, new_size);
    if (new_size == 0) {
        free(old);
        return NULL;
    }
    return realloc(old, new_size);
}

/* Runs a task for each index below `tasks`. */
static inline void filtration__for_each(const filtration_parallel *p, int threads, int tasks, void (*task)(void *, int),
                                        void *context) {
    if (p->fn) {
        p->fn(p->user, tasks, task, context);
        return;
    }
    (void)threads;
#ifdef _OPENMP
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
#endif
    for (int i = 0; i < tasks; i++) task(context, i);
}
