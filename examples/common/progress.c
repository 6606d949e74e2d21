#define _POSIX_C_SOURCE 200809L
#include "progress.h"

#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "machine.h"

static volatile sig_atomic_t caught_signal;
static volatile sig_atomic_t failed;
static bool quiet_run;
static const char *program_name = "riddle";
static pthread_mutex_t printing = PTHREAD_MUTEX_INITIALIZER;

static void on_signal(int number) { caught_signal = number; }

void common_catch_interrupt(void) {
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    action.sa_flags = (int)SA_RESETHAND; /* the second one ends the program */
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

bool common_interrupted(void) { return caught_signal != 0; }

int common_exit_status(void) {
    if (caught_signal) {
        fprintf(stderr, "%s: interrupted\n", program_name);
        return 128 + (int)caught_signal;
    }
    if (fflush(stdout) != 0 || ferror(stdout)) common_fail("cannot write to standard output");
    return failed ? 1 : 0;
}

void common_set_quiet(bool quiet) { quiet_run = quiet; }

bool common_quiet(void) { return quiet_run; }

void common_set_name(const char *name) { program_name = name; }

void common_print(const char *format, ...) {
    if (quiet_run) return;
    va_list arguments;
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    fflush(stdout);
}

int common_fail(const char *format, ...) {
    char line[1000];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    for (char *c = line; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127) *c = '?';
    fprintf(stderr, "%s: %s\n", program_name, line);
    failed = 1;
    return -1;
}

static void clock_text(double seconds, char *text, size_t size) {
    if (!(seconds >= 0.0) || seconds > 360000.0) snprintf(text, size, "--:--");
    else if (seconds < 3600.0) snprintf(text, size, "%d:%02d", (int)seconds / 60, (int)seconds % 60);
    else snprintf(text, size, "%d:%02d:%02d", (int)seconds / 3600, (int)seconds / 60 % 60, (int)seconds % 60);
}

static void draw(progress *bar, double now) {
    double share = bar->total > 0.0 ? bar->done / bar->total : 1.0;
    if (!(share > 0.0)) share = 0.0;
    if (share > 1.0) share = 1.0;
    double elapsed = now - bar->began;
    char left[32];
    clock_text(share > 0.0 ? elapsed * (1.0 - share) / share : -1.0, left, sizeof left);
    if (bar->terminal) {
        enum { WIDTH = 30 };
        char cells[WIDTH + 1];
        int full = (int)(share * WIDTH);
        for (int i = 0; i < WIDTH; i++) cells[i] = i < full ? '#' : '.';
        cells[WIDTH] = '\0';
        fprintf(stderr, "\r%-24.24s [%s] %3d %%  %s left \033[K", bar->what, cells, (int)(100.0 * share), left);
        fflush(stderr);
    } else if ((int)(4.0 * share) > bar->quarter && share < 1.0) {
        bar->quarter = (int)(4.0 * share);
        fprintf(stderr, "%s: %d %%, %s left\n", bar->what, 25 * bar->quarter, left);
    }
    bar->printed = now;
}

void progress_begin(progress *bar, const char *what, double total) {
    bar->what = what;
    bar->total = total;
    bar->done = 0.0;
    bar->began = machine_seconds();
    bar->printed = -HUGE_VAL;
    bar->quarter = 0;
    bar->terminal = isatty(STDERR_FILENO) == 1;
    bar->active = !quiet_run;
}

static void advance(progress *bar, double done, double more) {
    if (!bar->active) return;
    pthread_mutex_lock(&printing);
    bar->done = (more != 0.0 ? bar->done : done) + more;
    double now = machine_seconds();
    if (now - bar->printed >= 0.1) draw(bar, now);
    pthread_mutex_unlock(&printing);
}

void progress_update(progress *bar, double done) { advance(bar, done, 0.0); }

void progress_add(progress *bar, double more) {
    if (more != 0.0) advance(bar, 0.0, more);
}

void progress_end(progress *bar) {
    if (!bar->active) return;
    pthread_mutex_lock(&printing);
    double elapsed = machine_seconds() - bar->began;
    if (bar->terminal) fprintf(stderr, "\r\033[K");
    fprintf(stderr, "%s: %s %.1f s\n", bar->what, common_interrupted() ? "stopped after" : "done in", elapsed);
    pthread_mutex_unlock(&printing);
    bar->active = false;
}
