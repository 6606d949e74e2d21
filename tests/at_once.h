/* at_once.h: a host's threads for tests: each task of a loop on one of its own, the last one first. */
#ifndef RIDDLE_AT_ONCE_H
#define RIDDLE_AT_ONCE_H

#include <pthread.h>

typedef struct one_task {
    void (*task)(void *context, int index);
    void *context;
    int index;
} one_task;
static void *do_task(void *of) {
    const one_task *t = (const one_task *)of;
    t->task(t->context, t->index);
    return NULL;
}
/* Returns how many threads have begun. A task whose thread cannot begin, or beyond 64, is done here. */
static inline int run_at_once(int tasks, void (*task)(void *context, int index), void *context) {
    pthread_t thread[64];
    one_task of[64];
    int begun = 0;
    for (; begun < tasks && begun < 64; begun++) {
        of[begun].task = task, of[begun].context = context, of[begun].index = tasks - 1 - begun;
        if (pthread_create(&thread[begun], NULL, do_task, &of[begun]) != 0) break;
    }
    for (int k = tasks - 1 - begun; k >= 0; k--) task(context, k);
    for (int k = 0; k < begun; k++) pthread_join(thread[k], NULL);
    return begun;
}

#endif
