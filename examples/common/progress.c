#define _POSIX_C_SOURCE 200809L
#include "progress.h"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t caught_signal;
static volatile sig_atomic_t failed;
static bool quiet_run;
static const char *program_name = "riddle";
static pthread_mutex_t printing = PTHREAD_MUTEX_INITIALIZER;

static volatile sig_atomic_t ends_at_once;

static void on_signal(int number) {
    caught_signal = number;
    if (!ends_at_once) return;
    static const char said[] = ": interrupted\n"; /* write and _exit are what a handler may call */
    ssize_t written = write(STDERR_FILENO, program_name, strlen(program_name));
    if (written > 0) written = write(STDERR_FILENO, said, sizeof said - 1);
    (void)written;
    _exit(128 + number);
}

/* The second one ends the program, because a signal that has been caught is not caught again. */
#if defined(_WIN32) || defined(__wasi__)

void common_open_standard_streams(void) {}
void common_catch_interrupt(void) {
    signal(SIGINT, on_signal);
    signal(SIGTERM, on_signal);
}

#else

void common_open_standard_streams(void) {
    /* The lowest free number is taken; reading only: to write there fails. */
    for (int descriptor = 0; descriptor <= 2; descriptor++)
        if (fcntl(descriptor, F_GETFD) < 0 && open("/dev/null", O_RDONLY) < 0) return;
}

void common_catch_interrupt(void) {
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE};
    struct sigaction action, before;
    memset(&action, 0, sizeof action);
    action.sa_handler = on_signal;
    sigemptyset(&action.sa_mask);
    for (int k = 0; k < (int)(sizeof numbers / sizeof *numbers); k++) {
        action.sa_flags =
            /* The second one ends the program; each line to a closed pipe is one. */
            numbers[k] == SIGPIPE ? 0 : (int)SA_RESETHAND;
        const bool by_nohup =
            numbers[k] == SIGHUP && sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler == SIG_IGN;
        if (!by_nohup) sigaction(numbers[k], &action, NULL);
    }
}

#endif

void common_interrupt_at_once(bool at_once) { ends_at_once = at_once; }

bool common_interrupted(void) { return caught_signal != 0; }

int common_exit_status(void) {
    static bool told;
    const bool lost = !caught_signal && (fflush(stdout) != 0 || ferror(stdout));
    if (caught_signal && !told) fprintf(stderr, "%s: interrupted\n", program_name);
    if (lost && !told) common_fail("cannot write to standard output");
    told |= caught_signal || lost;
    return caught_signal ? 128 + (int)caught_signal : failed ? 1 : 0;
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

void progress_begin(progress *bar, const char *what, double total) {
    riddle_io_progress_begin(bar, what, total);
    bar->active = !quiet_run;
}

void progress_update(progress *bar, double done) {
    pthread_mutex_lock(&printing);
    riddle_io_progress_update(bar, done);
    pthread_mutex_unlock(&printing);
}

void progress_add(progress *bar, double more) {
    pthread_mutex_lock(&printing);
    riddle_io_progress_update(bar, bar->done + more);
    pthread_mutex_unlock(&printing);
}

void progress_end(progress *bar) {
    pthread_mutex_lock(&printing);
    riddle_io_progress_end(bar, common_interrupted() ? "stopped after" : NULL);
    pthread_mutex_unlock(&printing);
}
