#define _XOPEN_SOURCE 700
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifndef _WIN32
#include <sys/file.h>
#endif
#include <unistd.h>

static void created(const char *name);
static void gone(const char *name);
static void say(const char *line);

#define RIDDLE_IO_API extern
#define RIDDLE_IO_IMPLEMENTATION
#define RIDDLE_PLOT_API extern
#define RIDDLE_PLOT_IMPLEMENTATION
#define RIDDLE_IO_FAIL(line) say(line)
#define RIDDLE_IO_CREATED(name) created(name)
#define RIDDLE_IO_GONE(name) gone(name)
#include "output.h"

static void say(const char *line) { common_fail("%s", line); }

/* Every file that is half written, so that leaving early removes it. */
enum { MOST_FILES = 256 };
static char *half_written[MOST_FILES];
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static void remove_half_written(void) {
    for (int i = 0; i < MOST_FILES; i++)
        if (half_written[i]) unlink(half_written[i]);
}

static void created(const char *name) {
    static int registered;
    char *copy = malloc(strlen(name) + 1);
    pthread_mutex_lock(&lock);
    if (!registered) registered = atexit(remove_half_written) == 0;
    for (int i = 0; copy && i < MOST_FILES; i++)
        if (!half_written[i]) {
            half_written[i] = strcpy(copy, name);
            copy = NULL;
        }
    pthread_mutex_unlock(&lock);
    free(copy);
}

static void gone(const char *name) {
    pthread_mutex_lock(&lock);
    for (int i = 0; i < MOST_FILES; i++)
        if (half_written[i] && strcmp(half_written[i], name) == 0) {
            free(half_written[i]);
            half_written[i] = NULL;
        }
    pthread_mutex_unlock(&lock);
}

const char *output_find(char *buffer, size_t size, const char *name) {
    riddle_io_path(buffer, size, NULL, name);
#ifdef RIDDLE_ROOT /* meson.build sets it */
    if (access(buffer, F_OK) != 0) riddle_io_path(buffer, size, RIDDLE_ROOT, name);
#endif
    return buffer;
}

int output_hold_folder(const char *folder) {
#if defined(LOCK_EX) && defined(LOCK_NB)
    const int descriptor = open(folder, O_RDONLY | O_CLOEXEC);
    if (descriptor >= 0 && flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
        const int error = errno; /* others than this: no locks on this file system */
        close(descriptor);
        return error == EWOULDBLOCK ? -1 : 0;
    }
#else
    (void)folder;
#endif
    return 0; /* the descriptor stays open: the system drops the lock with the program */
}

riddle_io_file *csv_open(const char *folder, const char *name, const char *header) {
    riddle_io_file *c = riddle_io_open(folder, name);
    riddle_io_print(c, "%s\n", header);
    return c;
}

int csv_line(riddle_io_file *c, const char *format, ...) {
    if (!c) return -1;
    char line[4000];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    if (length < 0 || length >= (int)sizeof line) return common_fail("a row of %d characters is too long", length);
    return (int)riddle_io_print(c, "%s\n", line);
}

void table_end(riddle_io_table *t) { riddle_io_table_end(t, common_quiet() ? NULL : stdout); }

void figure_left_out(const char *folder, const char *name, const char *why) {
    char path[4096];
    common_print("%s is left out: %s\n", name, why);
    remove(riddle_io_path(path, sizeof path, folder, name));
}
