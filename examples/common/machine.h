/* machine.h: clock, memory, cores, and independent jobs on threads. */
#ifndef RIDDLE_MACHINE_H
#define RIDDLE_MACHINE_H

#include <stddef.h>

double machine_seconds(void);           /* monotonic wall clock [s], origin arbitrary */
double machine_processor_seconds(void); /* processor time of the whole process so far [s] */
double machine_peak_memory_bytes(void); /* largest resident memory so far [B] */
double
/* What the process may still take: of the machine, its container, its limit [B]; infinite: unknown. */
machine_free_memory_bytes(void);
/* realloc and free for a header's memory hook, but NULL where a large array would take more than is free: so that the
   run ends with a message and whole files. user: ignored. */
void *machine_resize(void *user, void *old, size_t old_size, size_t new_size);
int machine_cores(void); /* processors this process may run on, at least 1 */

/* Runs job(i, user) for i = 0 .. n-1 on up to `threads` threads (the caller's counts as one; one case per core). Jobs
   are handed out in order; none is begun after Ctrl-C. Returns the number of jobs that returned nonzero or were not
   begun. Each job must write only to its own slot of *user. */
int jobs_run(int n, int threads, int (*job)(int index, void *user), void *user);

#endif
