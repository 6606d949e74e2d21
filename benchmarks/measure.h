/* measure.h: what benchmarks measure with. */
#ifndef RIDDLE_MEASURE_H
#define RIDDLE_MEASURE_H

#include <stdlib.h>

/* Sorts. */
static inline double median(double *values, int n) {
    for (int i = 1; i < n; i++) {
        double v = values[i];
        int k = i;
        for (; k > 0 && values[k - 1] > v; k--) values[k] = values[k - 1];
        values[k] = v;
    }
    return n % 2 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

/* Bytes that are allocated now, and at most at one time. */
typedef struct memory {
    double now, most;
} memory;

/* An allocator for a world; user: a memory. */
static inline void *counted(void *user, void *old, size_t old_size, size_t new_size) {
    memory *m = user;
    void *fresh = new_size ? realloc(old, new_size) : NULL;
    if (!new_size) free(old);
    if (fresh || !new_size) m->now += (double)new_size - (double)old_size;
    if (m->now > m->most) m->most = m->now;
    return fresh;
}

#endif
