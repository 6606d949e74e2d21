#define _GNU_SOURCE
#include "machine.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#ifdef _WIN32
#include <windows.h>

#include <psapi.h>
#elif !defined(__wasi__)
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>
#endif

#include "progress.h"

static double seconds_of(clockid_t which) {
    struct timespec now;
    clock_gettime(which, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double machine_seconds(void) { return seconds_of(CLOCK_MONOTONIC); }

double machine_processor_seconds(void) { return seconds_of(CLOCK_PROCESS_CPUTIME_ID); }

#ifdef _WIN32

double machine_peak_memory_bytes(void) {
    PROCESS_MEMORY_COUNTERS counters;
    return GetProcessMemoryInfo(GetCurrentProcess(), &counters, sizeof counters) ? (double)counters.PeakWorkingSetSize
                                                                                 : 0.0;
}

double machine_free_memory_bytes(void) {
    MEMORYSTATUSEX status;
    status.dwLength = sizeof status;
    return GlobalMemoryStatusEx(&status) ? (double)status.ullAvailPhys : HUGE_VAL;
}

int machine_cores(void) {
    SYSTEM_INFO info;
    GetSystemInfo(&info);
    return info.dwNumberOfProcessors > 0 ? (int)info.dwNumberOfProcessors : 1;
}

#elif defined(__wasi__) /* a page: one thread, memory that only grows */

double machine_peak_memory_bytes(void) { return 65536.0 * (double)__builtin_wasm_memory_size(0); }
double machine_free_memory_bytes(void) { return HUGE_VAL; }
int machine_cores(void) { return 1; }

#else

double machine_peak_memory_bytes(void) {
    struct rusage usage;
    if (getrusage(RUSAGE_SELF, &usage) != 0) return 0.0;
#ifdef __APPLE__
    return (double)usage.ru_maxrss;
#else
    return 1024.0 * (double)usage.ru_maxrss;
#endif
}

/* The number after `key` in a file; infinite if there is none. */
static double number_in(const char *path, const char *key) {
    FILE *file = fopen(path, "r");
    char line[200];
    double value = HUGE_VAL;
    while (file && value == HUGE_VAL && fgets(line, sizeof line, file))
        if (strncmp(line, key, strlen(key)) == 0 && sscanf(line + strlen(key), "%lf", &value) != 1) value = HUGE_VAL;
    if (file) fclose(file);
    return value;
}

/* What is left below a limit of which a part is used; a limit of any program of the machine may be a huge number. */
static double below(double limit, double used) {
    return limit < 1e18 ? fmax(limit - (used < HUGE_VAL ? used : 0.0), 0.0) : HUGE_VAL;
}

double machine_free_memory_bytes(void) {
    struct rlimit limit;
    double most = 1024.0 * number_in("/proc/meminfo", "MemAvailable:");
    if (most == HUGE_VAL && sysconf(_SC_PHYS_PAGES) > 0)
        most = (double)sysconf(_SC_PHYS_PAGES) * (double)sysconf(_SC_PAGESIZE);
    most =
        fmin(most, below(number_in("/sys/fs/cgroup/memory.max", ""), number_in("/sys/fs/cgroup/memory.current", "")));
    most = fmin(most, below(number_in("/sys/fs/cgroup/memory/memory.limit_in_bytes", ""),
                            number_in("/sys/fs/cgroup/memory/memory.usage_in_bytes", "")));
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        most = fmin(most, below((double)limit.rlim_cur, 1024.0 * number_in("/proc/self/status", "VmSize:")));
    return most;
}

int machine_cores(void) {
#ifdef __linux__
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0 && CPU_COUNT(&set) > 0) return CPU_COUNT(&set);
#endif
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    return cores > 0 ? (int)cores : 1;
}

#endif

void *machine_resize(void *user, void *old, size_t old_size, size_t new_size) {
    enum { LARGE = 1 << 26 }; /* [B] to ask the system takes some 30 us */
    (void)user;
    if (new_size == 0) {
        free(old);
        return NULL;
    }
    if (new_size > old_size && new_size >= LARGE && (double)(new_size - old_size) > machine_free_memory_bytes())
        return NULL;
    return realloc(old, new_size);
}

typedef struct {
    pthread_mutex_t lock;
    int n, next, failed;
    int (*job)(int, void *);
    void *user;
} pool;

static void *work(void *argument) {
    pool *p = argument;
    for (;;) {
        pthread_mutex_lock(&p->lock);
        int index = p->next < p->n && !common_interrupted() ? p->next++ : -1;
        pthread_mutex_unlock(&p->lock);
        if (index < 0) return NULL;
        int status = p->job(index, p->user);
        pthread_mutex_lock(&p->lock);
        if (status == 0) p->failed--;
        pthread_mutex_unlock(&p->lock);
    }
}

int jobs_run(int n, int threads, int (*job)(int index, void *user), void *user) {
    if (n <= 0) return 0;
    pool p = {PTHREAD_MUTEX_INITIALIZER, n, 0, n, job, user};
    int extra = (threads < n ? threads : n) - 1, started = 0;
    pthread_t *workers = extra > 0 ? malloc((size_t)extra * sizeof *workers) : NULL;
    /* fewer threads than asked for, down to the caller's own, only take longer */
    while (workers && started < extra && pthread_create(&workers[started], NULL, work, &p) == 0) started++;
    work(&p);
    for (int i = 0; i < started; i++) pthread_join(workers[i], NULL);
    free(workers);
    pthread_mutex_destroy(&p.lock);
    return p.failed;
}
