#define _XOPEN_SOURCE 700
#include "output.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct output {
    FILE *stream;
    char *path;      /* as it will be called */
    char *temporary; /* as it is called now; NULL: written directly */
    int error;       /* errno of the first failure */
    output *next;
};

/* Every file that is open, so that leaving early removes what is half written. */
static output *open_files;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static void remove_open_files(void) {
    for (output *f = open_files; f; f = f->next)
        if (f->temporary) unlink(f->temporary);
}

static void enlist(output *file) {
    static int registered;
    pthread_mutex_lock(&lock);
    if (!registered) registered = atexit(remove_open_files) == 0;
    file->next = open_files;
    open_files = file;
    pthread_mutex_unlock(&lock);
}

static void delist(output *file) {
    pthread_mutex_lock(&lock);
    for (output **at = &open_files; *at; at = &(*at)->next)
        if (*at == file) {
            *at = file->next;
            break;
        }
    pthread_mutex_unlock(&lock);
}

static void release(output *file) {
    free(file->path);
    free(file->temporary);
    free(file);
}

static char *joined(const char *a, const char *between, const char *b) {
    size_t size = strlen(a) + strlen(between) + strlen(b) + 1;
    char *text = malloc(size);
    if (text) snprintf(text, size, "%s%s%s", a, between, b);
    return text;
}

/* "dir/name" -> "dir/.name.123.0.part" beside it */
static char *temporary_name(const char *path, int attempt) {
    const char *slash = strrchr(path, '/');
    size_t folder = slash ? (size_t)(slash - path) + 1 : 0, size = strlen(path) + 50;
    char *text = malloc(size);
    if (text) snprintf(text, size, "%.*s.%s.%ld.%d.part", (int)folder, path, path + folder, (long)getpid(), attempt);
    return text;
}

const char *output_path(char *buffer, size_t size, const char *folder, const char *name) {
    snprintf(buffer, size, "%s%s%s", folder ? folder : "", folder ? "/" : "", name);
    return buffer;
}

static bool is_standard_output(const char *path) { return strcmp(path, "-") == 0 || strcmp(path, "/dev/stdout") == 0; }

const char *output_find(char *buffer, size_t size, const char *name) {
    output_path(buffer, size, NULL, name);
#ifdef RIDDLE_ROOT /* meson.build sets it */
    if (access(buffer, F_OK) != 0) output_path(buffer, size, RIDDLE_ROOT, name);
#endif
    return buffer;
}

/* A new file beside `path`, or `path` itself where it is a device or a pipe. */
static FILE *open_beside(const char *path, char **temporary) {
    struct stat info;
    *temporary = NULL;
    if (is_standard_output(path)) { /* where it is redirected to a file, that file must not be replaced */
        fflush(stdout);
        int descriptor = dup(STDOUT_FILENO);
        return descriptor < 0 ? NULL : fdopen(descriptor, "wb");
    }
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode)) {
        if (S_ISDIR(info.st_mode)) {
            errno = EISDIR;
            return NULL;
        }
        return fopen(path, "wb");
    }
    for (int attempt = 0; attempt < 100; attempt++) {
        char *name = temporary_name(path, attempt);
        if (!name) return NULL;
        int descriptor = open(name, O_CREAT | O_EXCL | O_WRONLY, 0666);
        if (descriptor >= 0) {
            FILE *stream = fdopen(descriptor, "wb");
            if (!stream) {
                close(descriptor);
                unlink(name);
                free(name);
                return NULL;
            }
            *temporary = name;
            return stream;
        }
        free(name);
        if (errno != EEXIST) return NULL;
    }
    return NULL;
}

output *output_open(const char *folder, const char *name) {
    output *file = calloc(1, sizeof *file);
    char *wanted = folder ? joined(folder, "/", name) : joined(name, "", "");
    if (!file || !wanted) {
        free(file);
        free(wanted);
        common_fail("%s: out of memory", name);
        return NULL;
    }
    char *real = is_standard_output(wanted) ? NULL : realpath(wanted, NULL); /* a link stays a link; its target is replaced */
    file->path = real ? real : wanted;
    if (real) free(wanted);
    file->stream = open_beside(file->path, &file->temporary);
    if (!file->stream) {
        common_fail("%s: %s", file->path, strerror(errno));
        release(file);
        return NULL;
    }
    enlist(file);
    return file;
}

int output_write(output *file, const void *bytes, size_t size) {
    if (!file) return -1;
    if (file->error) return -1;
    errno = 0;
    if (size && fwrite(bytes, 1, size, file->stream) != size) file->error = errno ? errno : EIO;
    return file->error ? -1 : 0;
}

int output_print(output *file, const char *format, ...) {
    if (!file) return -1;
    if (file->error) return -1;
    va_list arguments;
    va_start(arguments, format);
    errno = 0;
    if (vfprintf(file->stream, format, arguments) < 0) file->error = errno ? errno : EIO;
    va_end(arguments);
    return file->error ? -1 : 0;
}

void output_discard(output *file) {
    if (!file) return;
    fclose(file->stream);
    if (file->temporary) unlink(file->temporary);
    delist(file);
    release(file);
}

int output_close(output *file) {
    if (!file) return -1;
    errno = 0;
    if (!file->error && (fflush(file->stream) != 0 || ferror(file->stream))) file->error = errno ? errno : EIO;
    if (fclose(file->stream) != 0 && !file->error) file->error = errno ? errno : EIO;
    if (!file->error && file->temporary && rename(file->temporary, file->path) != 0) file->error = errno;
    int status = 0;
    if (file->error) {
        status = common_fail("%s: %s", file->path, strerror(file->error));
        if (file->temporary) unlink(file->temporary);
    }
    delist(file);
    release(file);
    return status;
}

int output_can_write(const char *path, char *message, size_t size) {
    char *temporary = NULL;
    FILE *stream = open_beside(path, &temporary);
    if (!stream) {
        snprintf(message, size, "%s", strerror(errno));
        return -1;
    }
    fclose(stream);
    if (temporary) unlink(temporary);
    free(temporary);
    return 0;
}

int output_make_folder(const char *path, char *message, size_t size) {
    char *partial = joined(path, "/", "");
    if (!partial) {
        snprintf(message, size, "out of memory");
        return -1;
    }
    int failed = 0;
    for (char *c = partial + 1; *c && !failed; c++) {
        if (*c != '/' || c[-1] == '/') continue;
        *c = '\0';
        struct stat info;
        if (mkdir(partial, 0777) != 0) {
            int why = errno;
            if (stat(partial, &info) != 0) failed = why;
            else if (!S_ISDIR(info.st_mode)) failed = ENOTDIR;
        }
        *c = '/';
    }
    free(partial);
    if (failed) {
        snprintf(message, size, "%s", strerror(failed));
        return -1;
    }
    char *trial = joined(path, "/", "trial");
    int status = trial ? output_can_write(trial, message, size) : -1;
    if (!trial) snprintf(message, size, "out of memory");
    free(trial);
    return status;
}
