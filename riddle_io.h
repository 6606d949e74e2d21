/* riddle_io.h: what a simulation writes: ParaView files, CSV, tables, a progress bar. Every file is whole or absent.

   #include "riddle_io.h"

   int main(void) {
       double xyz[] = {0, 0, 0, 0, 0, 0.01}, radius[] = {0.005, 0.004};
       // folder and file: "out", "grains.csv"
       riddle_io_file *file = riddle_io_open(NULL, "/dev/null");
       riddle_io_print(file, "first_radius_m,second_radius_m\n");
       riddle_io_row(file, radius, 2);
       riddle_io_status status = riddle_io_close(file);
       riddle_io_array of_points[] = {riddle_io_scalar("radius_m", radius)};
       return status || riddle_io_points(NULL, "/dev/null", 2, riddle_io_vector("position", xyz), of_points, 1);
   }

   Files    riddle_io_open, _print, _write, _row, _close: a file is written under a temporary name beside its own and
            renamed when it is closed; if anything failed, nothing is left and an older file of that name stays. Folders
            that are missing are made. A device and a pipe are written directly; "-" is standard output.
   ParaView .vtp points, lines, polygons; .vti regular grids (binary, little-endian, float32, int32); .pvd index of a
   time series.
            The format: VTK File Formats, Kitware.
   Locale   numbers have a decimal point, whatever locale the host has set (tables and the progress bar, for people,
            have the host's).
   Units    the caller's: names are written as they are given.
   Errors   a function that fails hands one line ("out/a.csv: No space left on device") to RIDDLE_IO_FAIL, returns its
            status, and leaves nothing half written. Every function takes the NULL that another returned and does
            nothing.
   Hooks    macros, to be set before the inclusion (of the one file with the bodies, where there is one); riddle_plot.h
            has the same:
            RIDDLE_IO_FAIL(line)                          what to do with an error's line; default: print it on stderr
            RIDDLE_IO_REALLOC(old, size), RIDDLE_IO_FREE(old)   memory; default: realloc, free
            RIDDLE_IO_CREATED(name), RIDDLE_IO_GONE(name) a temporary file has come into being or has gone, for hosts
            that clean up
                                                          when they leave early; default: nothing
   Memory   an object lives from its _open or _new to its _close or _end.
   Threads  no state but the caller's objects: one object is used by one thread at a time.
   Bits     the same input gives the same file with the same C library.
   Linking  every function is static inline. For one shared copy: #define RIDDLE_IO_API extern before every inclusion,
            and RIDDLE_IO_IMPLEMENTATION as well in one file.
   Not here: reading; figures (riddle_plot.h). The physics headers know nothing of this one: it takes plain arrays. */
#ifndef RIDDLE_IO_H
#define RIDDLE_IO_H

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "riddle_io.h needs NaN and infinity: compile without -ffast-math"
#endif

#include <stddef.h>
#include <stdio.h>

#ifndef RIDDLE_IO_API
#define RIDDLE_IO_API static inline
#define RIDDLE_IO__BODIES
#elif defined(RIDDLE_IO_IMPLEMENTATION)
#define RIDDLE_IO__BODIES
#endif

#if defined(__MINGW32__)
#define RIDDLE_IO__PRINTF(text, first) __attribute__((format(gnu_printf, text, first)))
#elif defined(__GNUC__)
#define RIDDLE_IO__PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define RIDDLE_IO__PRINTF(text, first)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ===================================================== status ===================================================== */

#define RIDDLE_IO_STATUSES(X)                                                                                          \
    X(RIDDLE_IO_OK, "ok")                                                                                              \
    X(RIDDLE_IO_BAD_ARGUMENT, "an argument is NULL or out of its range")                                               \
    X(RIDDLE_IO_NO_MEMORY, "out of memory")                                                                            \
    X(RIDDLE_IO_NOT_WRITTEN, "a file or folder could not be written")

#define RIDDLE_IO__NAME(name, text) name,
typedef enum riddle_io_status { RIDDLE_IO_STATUSES(RIDDLE_IO__NAME) RIDDLE_IO_STATUS_COUNT } riddle_io_status;
#undef RIDDLE_IO__NAME

RIDDLE_IO_API const char *riddle_io_status_text(riddle_io_status status); /* never NULL */

/* ===================================================== files ====================================================== */

typedef struct riddle_io_file riddle_io_file;

/* Begins a file. folder may be NULL: name is then a whole path. Missing folders are made. NULL after an error. */
RIDDLE_IO_API riddle_io_file *riddle_io_open(const char *folder, const char *name);
RIDDLE_IO_API riddle_io_status riddle_io_print(riddle_io_file *file, const char *format, ...) RIDDLE_IO__PRINTF(2, 3);
RIDDLE_IO_API riddle_io_status riddle_io_write(riddle_io_file *file, const void *bytes, size_t size);
/* Writes one row of CSV: numbers with as many digits as they need to be read back as they are (0.06), commas between,
   an empty cell for a number that is not finite. */
RIDDLE_IO_API riddle_io_status riddle_io_row(riddle_io_file *file, const double *values, int n);
/* Closes the file. RIDDLE_IO_OK: the file exists under its name. Otherwise nothing is left, whichever of the calls
   above failed. Frees the object. */
RIDDLE_IO_API riddle_io_status riddle_io_close(riddle_io_file *file);
RIDDLE_IO_API void riddle_io_discard(riddle_io_file *file); /* closes it and leaves nothing */

/* Makes a folder and its parents, and checks that it can be written to. message (may be NULL): the reason
   of a failure. */
RIDDLE_IO_API riddle_io_status riddle_io_make_folder(const char *path, char *message, size_t size);
/* Checks whether a file of that name could be written now; its folder must exist. message: the reason of a failure. */
RIDDLE_IO_API riddle_io_status riddle_io_can_write(const char *path, char *message, size_t size);
/* Writes "folder/name" to buffer, and returns buffer. folder may be NULL. Where it does not fit, buffer is empty: no
   other file's name. */
RIDDLE_IO_API const char *riddle_io_path(char *buffer, size_t size, const char *folder, const char *name);

/* ==================================================== ParaView ==================================================== */

/* A view of the caller's array, made by the functions below; nothing is copied before writing. */
typedef struct riddle_io_array {
    const char *name; /* with the unit where there is one: "velocity_m_s" */
    int components;   /* 1 or 3 */
    int stride;       /* between neighbours in data[k] */
    const double *data[3];
    const float *floats; /* one of data, floats, ints is not NULL */
    const int *ints;
} riddle_io_array;

/* [n] */
RIDDLE_IO_API riddle_io_array riddle_io_scalar(const char *name, const double *values);
/* [n] */
RIDDLE_IO_API riddle_io_array riddle_io_scalar_float(const char *name, const float *values);
/* [n] */
RIDDLE_IO_API riddle_io_array riddle_io_ints(const char *name, const int *values);
/* [n][3] */
RIDDLE_IO_API riddle_io_array riddle_io_vector(const char *name, const double *xyz);
/* Three of [n]. */
RIDDLE_IO_API riddle_io_array riddle_io_vector3(const char *name, const double *x, const double *y, const double *z);
/* xyz + i * stride [doubles] */
RIDDLE_IO_API riddle_io_array riddle_io_vector_stride(const char *name, const double *xyz, int stride);

/* Writes n points with their arrays, one vertex each (Glyph or Point Gaussian in ParaView). An array is written as
   often as position: [n]. */
RIDDLE_IO_API riddle_io_status riddle_io_points(const char *folder, const char *name, int n, riddle_io_array position,
                                                const riddle_io_array *arrays, int n_arrays);
/* Writes lines or polygons: cell c joins corners[ends[c-1]] .. corners[ends[c]-1] (0-based points; ends[-1] is 0).
   Arrays belong to the points. */
RIDDLE_IO_API riddle_io_status riddle_io_lines(const char *folder, const char *name, int n_points,
                                               riddle_io_array position, int n_cells, const int *ends,
                                               const int *corners, const riddle_io_array *arrays, int n_arrays);
RIDDLE_IO_API riddle_io_status riddle_io_polygons(const char *folder, const char *name, int n_points,
                                                  riddle_io_array position, int n_cells, const int *ends,
                                                  const int *corners, const riddle_io_array *arrays, int n_arrays);
/* Writes a regular grid of size[0] x size[1] x size[2] cells, first index fastest; origin and spacing [m]. Arrays
   belong to the cells. */
RIDDLE_IO_API riddle_io_status riddle_io_cells(const char *folder, const char *name, const int size[3],
                                               const double origin[3], const double spacing[3],
                                               const riddle_io_array *arrays, int n_arrays);

/* The index of a time series: grains.pvd lists grains_0000.vtp, ... and is written anew, whole, at each frame. What
   moves differently (grains, walls) is a series of its own:
       riddle_io_points("out", riddle_io_series_name(series, time), n, position, arrays, n_arrays);
   folder as in riddle_io_open; name: with or without ".pvd", of RIDDLE_IO_SERIES_BYTES at most; a folder in it is made.
   NULL after an error. */
enum { RIDDLE_IO_SERIES_BYTES = 1000 };
typedef struct riddle_io_series riddle_io_series;
RIDDLE_IO_API riddle_io_series *riddle_io_series_open(const char *folder, const char *name);
/* Returns the next frame's file name (below the folder of the series), valid until the next call; the index lists it as
   soon as the file is there. NULL after an error. extension: "vti", not "vtp"; 1 to 7 bytes. */
RIDDLE_IO_API const char *riddle_io_series_name(riddle_io_series *series, double time);
RIDDLE_IO_API const char *riddle_io_series_name_as(riddle_io_series *series, double time, const char *extension);
/* Leaves the frame just named out of the index: it was not written, and a file of that name is an older one. Its number
   is not used again. */
RIDDLE_IO_API void riddle_io_series_drop(riddle_io_series *series);
RIDDLE_IO_API riddle_io_status riddle_io_series_close(riddle_io_series *series);

/* =============================================== tables and progress ============================================== */

/* An aligned table of plain text.
       riddle_io_table t = riddle_io_table_begin("time [s]|retained small|retained near-mesh");
       // cells run on, row by row
       riddle_io_table_cell(&t, "%.1f", time);  riddle_io_table_cell(&t, "%.3f", small);  ...
       riddle_io_table_end(&t, stdout); */
enum { RIDDLE_IO_TABLE_COLUMNS = 24 };
typedef struct riddle_io_table {
    int columns;
    int cells;  /* so far, header included */
    char *text; /* the cells, each ended by 0 */
    size_t used, capacity;
} riddle_io_table;
/* at most RIDDLE_IO_TABLE_COLUMNS names between '|' */
RIDDLE_IO_API riddle_io_table riddle_io_table_begin(const char *header);
/* Adds a cell; of a longer text its first 399 bytes. */
RIDDLE_IO_API void riddle_io_table_cell(riddle_io_table *t, const char *format, ...) RIDDLE_IO__PRINTF(2, 3);
/* Prints and frees; numbers stand to the right, texts to the left. stream may be NULL: frees only. */
RIDDLE_IO_API void riddle_io_table_end(riddle_io_table *t, FILE *stream);

/* A bar with the time left on a terminal (stderr), else a line at each quarter. Owned by the caller. */
typedef struct riddle_io_progress {
    const char *what;
    double total, done;    /* in any unit, progress is done / total */
    double began, printed; /* riddle_io_seconds() */
    int quarter;
    int terminal, active; /* active 0: nothing is printed */
} riddle_io_progress;
RIDDLE_IO_API void riddle_io_progress_begin(riddle_io_progress *bar, const char *what, double total);
/* Cheap: at most 10 prints a second; one clock read. */
RIDDLE_IO_API void riddle_io_progress_update(riddle_io_progress *bar, double done);
/* "what: how 3.2 s"; how NULL: "done in" */
RIDDLE_IO_API void riddle_io_progress_end(riddle_io_progress *bar, const char *how);
/* Wall clock [s], origin arbitrary. */
RIDDLE_IO_API double riddle_io_seconds(void);

/* ========================================= >>shared with riddle_plot.h ============================================ */

#include <locale.h>
#include <stdlib.h>
#include <string.h>

#ifndef RIDDLE_IO_FAIL
#define RIDDLE_IO_FAIL(line) fprintf(stderr, "%s\n", line)
#endif
#ifndef RIDDLE_IO_REALLOC
#define RIDDLE_IO_REALLOC(old, size) realloc(old, size)
#define RIDDLE_IO_FREE(old) free(old)
#endif
#ifndef RIDDLE_IO_CREATED
#define RIDDLE_IO_CREATED(name) ((void)(name))
#define RIDDLE_IO_GONE(name) ((void)(name))
#endif

/* Hands on "what: why" and returns the status. what comes from outside: control characters become '?'. */
static inline riddle_io_status riddle_io__fail(riddle_io_status status, const char *what, const char *why) {
    char line[1000];
    /* of a longer path the end: the reason must fit in too */
    const size_t length = what ? strlen(what) : 0, room = 800;
    snprintf(line, sizeof line, "%s%.800s: %s", length > room ? "..." : "",
             what ? what + (length > room ? length - room : 0) : "", why);
    for (char *c = line; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127) *c = '?';
    RIDDLE_IO_FAIL(line);
    return status;
}

static inline riddle_io_status riddle_io__no_memory(const char *what) {
    return riddle_io__fail(RIDDLE_IO_NO_MEMORY, what, "out of memory");
}

static inline void riddle_io__release(void *memory) {
    if (memory) RIDDLE_IO_FREE(memory);
}

static inline void *riddle_io__zeroed(size_t size) {
    void *memory = RIDDLE_IO_REALLOC(NULL, size);
    if (memory) memset(memory, 0, size);
    return memory;
}

/* Puts a decimal point into a number that the C library has written: a host may have set a locale with a comma. */
static inline void riddle_io__use_point(char *number) {
    const char *mark = localeconv()->decimal_point;
    char *at = *mark ? strstr(number, mark) : NULL;
    if (!at || strcmp(mark, ".") == 0) return;
    *at = '.';
    memmove(at + 1, at + strlen(mark), strlen(at + strlen(mark)) + 1);
}

static inline int riddle_io__letters_of(const char *text) {
    int n = 0;
    for (; *text; text++) n += ((unsigned char)*text & 0xC0) != 0x80;
    return n;
}

#ifdef RIDDLE_IO__BODIES

/* ================================================= >>files: bodies ================================================ */

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/stat.h>
#include <sys/types.h>
#ifdef _WIN32
#include <direct.h>
#include <io.h>
#include <process.h>
#include <sys/timeb.h>
#else
#include <sys/time.h>
#include <unistd.h>
#endif

RIDDLE_IO_API const char *riddle_io_status_text(riddle_io_status status) {
#define RIDDLE_IO__TEXT(name, text)                                                                                    \
    case name: return text;
    switch (status) {
        RIDDLE_IO_STATUSES(RIDDLE_IO__TEXT)
    case RIDDLE_IO_STATUS_COUNT: break;
    }
#undef RIDDLE_IO__TEXT
    return "unknown status";
}

static inline char *riddle_io__joined(const char *a, const char *between, const char *b) {
    size_t size = strlen(a) + strlen(between) + strlen(b) + 1;
    char *text = (char *)RIDDLE_IO_REALLOC(NULL, size);
    if (text) snprintf(text, size, "%s%s%s", a, between, b);
    return text;
}

/* Copies a conversion such as "%-*.3lg" of a format to `spec`, with numbers in place of its stars. Returns
   what follows it. */
static inline const char *riddle_io__conversion(const char *at, char *spec, size_t size, va_list *arguments) {
    size_t n = 0;
    for (; n + 16 < size; at++) {
        if (*at == '*') n += (size_t)snprintf(spec + n, size - n, "%d", va_arg(*arguments, int));
        else spec[n++] = *at;
        if (!*at || (n > 1 && strchr("diouxXcspfFeEgGaAn%", *at))) break;
    }
    spec[n] = '\0';
    return *at ? at + 1 : at;
}

/* Writes what vfprintf writes, numbers with a decimal point in every locale. No long double. */
static inline bool riddle_io__print(FILE *stream, const char *format, va_list *arguments) {
    while (*format) {
        const size_t plain = strcspn(format, "%");
        char spec[80], number[400];
        if (plain && fwrite(format, 1, plain, stream) != plain) return false;
        format += plain;
        if (!*format) break;
        format = riddle_io__conversion(format, spec, sizeof spec, arguments);
        const char *last = spec + strlen(spec) - 1, *length = spec + strcspn(spec, "lzjt");
        int printed = 0;
        if (strchr("fFeEgGaA", *last)) {
            const int letters = snprintf(number, sizeof number, spec, va_arg(*arguments, double));
            if (letters < 0 || (size_t)letters >= sizeof number) {
                errno = ERANGE;
                return false;
            }
            riddle_io__use_point(number);
            printed = fputs(number, stream);
        } else if (*last == '%') printed = fputc('%', stream);
        else if (*last == 's') printed = fprintf(stream, spec, va_arg(*arguments, const char *));
        else if (*last == 'p') printed = fprintf(stream, spec, va_arg(*arguments, void *));
        else if (length[0] == 'z' || length[0] == 't') printed = fprintf(stream, spec, va_arg(*arguments, size_t));
        else if (length[0] == 'j') printed = fprintf(stream, spec, va_arg(*arguments, intmax_t));
        else if (length[0] == 'l' && length[1] == 'l') printed = fprintf(stream, spec, va_arg(*arguments, long long));
        else if (length[0] == 'l') printed = fprintf(stream, spec, va_arg(*arguments, long));
        else printed = fprintf(stream, spec, va_arg(*arguments, int));
        if (printed < 0) return false;
    }
    return true;
}

struct riddle_io_file {
    FILE *stream;
    char *path;      /* as it will be called */
    char *temporary; /* as it is called now; NULL: written directly */
    int error;       /* errno of the first failure */
};

static inline const char *riddle_io__last_slash(const char *path) {
    const char *slash = strrchr(path, '/');
#ifdef _WIN32
    const char *other = strrchr(path, '\\');
    if (other && (!slash || other > slash)) slash = other;
#endif
    return slash;
}

/* Returns the name of a temporary file beside a file: "dir/name" -> "dir/.name.123.0.part". The caller frees it. */
static inline char *riddle_io__temporary_name(const char *path, int attempt) {
    const char *slash = riddle_io__last_slash(path);
    size_t folder = slash ? (size_t)(slash - path) + 1 : 0, size = strlen(path) + 50;
    char *text = (char *)RIDDLE_IO_REALLOC(NULL, size);
    if (text) snprintf(text, size, "%.*s.%s.%ld.%d.part", (int)folder, path, path + folder, (long)getpid(), attempt);
    return text;
}

static inline bool riddle_io__is_standard_output(const char *path) {
    return strcmp(path, "-") == 0 || strcmp(path, "/dev/stdout") == 0;
}

static inline bool riddle_io__is_folder(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

static inline int riddle_io__make_one_folder(const char *path) {
#ifdef _WIN32
    return _mkdir(path);
#else
    return mkdir(path, 0777);
#endif
}

/* Creates a new file for writing. Returns NULL with errno if a file of that name exists, or cannot be created. */
static inline FILE *riddle_io__create(const char *name) {
#ifdef _WIN32
    int descriptor = _open(name, _O_CREAT | _O_EXCL | _O_WRONLY | _O_BINARY, _S_IREAD | _S_IWRITE);
    if (descriptor < 0) return NULL;
    _close(descriptor);
#else
    int descriptor = open(name, O_CREAT | O_EXCL | O_WRONLY, 0666);
    if (descriptor < 0) return NULL;
    close(descriptor);
#endif
    FILE *stream = fopen(name, "wb"); /* fdopen is not declared under -std=c99 */
    if (!stream) remove(name);
    return stream;
}

/* Opens a new file beside `path`, or `path` itself where it is a device or a pipe. */
static inline FILE *riddle_io__open_beside(const char *path, char **temporary) {
    struct stat info;
    *temporary = NULL;
    /* Where it is redirected to a file, that file must not be replaced. */
    if (riddle_io__is_standard_output(path)) return stdout;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode)) {
        if (S_ISDIR(info.st_mode)) {
            errno = EISDIR;
            return NULL;
        }
        return fopen(path, "wb");
    }
    for (int attempt = 0; attempt < 100; attempt++) {
        char *name = riddle_io__temporary_name(path, attempt);
        if (!name) {
            errno = ENOMEM;
            return NULL;
        }
        FILE *stream = riddle_io__create(name);
        if (stream) {
            *temporary = name;
            RIDDLE_IO_CREATED(name);
            return stream;
        }
        int why = errno;
        riddle_io__release(name);
        errno = why;
        if (why != EEXIST) return NULL;
    }
    return NULL;
}

static inline void riddle_io__forget(char *temporary, bool unwanted) {
    if (!temporary) return;
    if (unwanted) remove(temporary);
    RIDDLE_IO_GONE(temporary);
    riddle_io__release(temporary);
}

/* Returns a path whose links are resolved, so that a link stays one and its target is replaced; NULL where there is
   nothing yet. */
static inline char *riddle_io__resolved(const char *path) {
/* else it is not declared */
#if !defined(_WIN32) && (defined(_DEFAULT_SOURCE) || defined(_XOPEN_SOURCE) || defined(__APPLE__))
    char *real = riddle_io__is_standard_output(path) ? NULL : realpath(path, NULL), *copy = NULL;
    if (real) {
        copy = riddle_io__joined(real, "", "");
        free(real); /* the C library's own */
    }
    return copy;
#else
    (void)path;
    return NULL;
#endif
}

/* Makes the missing folders above a file. Returns errno of the first one that could not be made, or 0. */
static inline int riddle_io__make_parents(char *path) {
    int failed = 0;
    for (char *c = path; *c; c++) {
        if (c == path || c != riddle_io__last_slash(path) || riddle_io__is_folder(path)) continue;
        char *last = c;
        char kept = *last;
        *last = '\0';
        if (*path && !riddle_io__is_folder(path)) {
            const int above = riddle_io__make_parents(path), why = riddle_io__make_one_folder(path) == 0 ? 0 : errno;
            if (!failed) failed = above ? above : why;
        }
        *last = kept;
    }
    return failed;
}

RIDDLE_IO_API riddle_io_file *riddle_io_open(const char *folder, const char *name) {
    if (!name) {
        riddle_io__fail(RIDDLE_IO_BAD_ARGUMENT, folder, "a file without a name");
        return NULL;
    }
    riddle_io_file *file = (riddle_io_file *)riddle_io__zeroed(sizeof *file);
    char *wanted = folder ? riddle_io__joined(folder, "/", name) : riddle_io__joined(name, "", "");
    if (!file || !wanted) {
        riddle_io__release(file);
        riddle_io__release(wanted);
        riddle_io__no_memory(name);
        return NULL;
    }
    const int no_folder = riddle_io__make_parents(wanted);
    char *real = riddle_io__resolved(wanted);
    file->path = real ? real : wanted;
    if (real) riddle_io__release(wanted);
    file->stream = riddle_io__open_beside(file->path, &file->temporary);
    if (!file->stream) {
        riddle_io__fail(RIDDLE_IO_NOT_WRITTEN, file->path, strerror(errno == ENOENT && no_folder ? no_folder : errno));
        riddle_io__release(file->path);
        riddle_io__release(file);
        return NULL;
    }
    return file;
}

/* Keeps the first failure for riddle_io_close to tell. */
static inline riddle_io_status riddle_io__after(riddle_io_file *file, bool worked) {
    if (!worked && !file->error) file->error = errno ? errno : EIO;
    return file->error ? RIDDLE_IO_NOT_WRITTEN : RIDDLE_IO_OK;
}

RIDDLE_IO_API riddle_io_status riddle_io_write(riddle_io_file *file, const void *bytes, size_t size) {
    if (!file || (!bytes && size)) return RIDDLE_IO_BAD_ARGUMENT;
    if (file->error) return RIDDLE_IO_NOT_WRITTEN;
    errno = 0;
    return riddle_io__after(file, size == 0 || fwrite(bytes, 1, size, file->stream) == size);
}

RIDDLE_IO_API riddle_io_status riddle_io_print(riddle_io_file *file, const char *format, ...) {
    if (!file) return RIDDLE_IO_BAD_ARGUMENT;
    if (file->error) return RIDDLE_IO_NOT_WRITTEN;
    const bool point = strcmp(localeconv()->decimal_point, ".") == 0;
    va_list arguments;
    va_start(arguments, format);
    errno = 0;
    bool worked =
        point ? vfprintf(file->stream, format, arguments) >= 0 : riddle_io__print(file->stream, format, &arguments);
    va_end(arguments);
    return riddle_io__after(file, worked);
}

/* Returns the format of the fewest digits, of 15, 16 and 17, with which a number is read back as it is. */
static inline const char *riddle_io__format_of(double value) {
    static const char *const format[] = {"%.15g", "%.16g", "%.17g"};
    char text[40];
    int k = 0;
    for (; k < 2; k++) {
        snprintf(text, sizeof text, format[k], value);
        if (strtod(text, NULL) == value) break;
    }
    return format[k];
}

RIDDLE_IO_API riddle_io_status riddle_io_row(riddle_io_file *file, const double *values, int n) {
    if (!file || (!values && n > 0)) return RIDDLE_IO_BAD_ARGUMENT;
    for (int i = 0; i < n; i++) {
        if (i) riddle_io_print(file, ",");
        if (values[i] - values[i] == 0.0) riddle_io_print(file, riddle_io__format_of(values[i]), values[i]);
    }
    return riddle_io_print(file, "\n");
}

RIDDLE_IO_API void riddle_io_discard(riddle_io_file *file) {
    if (!file) return;
    if (file->stream != stdout) fclose(file->stream);
    riddle_io__forget(file->temporary, true);
    riddle_io__release(file->path);
    riddle_io__release(file);
}

/* Windows does not rename onto a file that is there. */
static inline bool riddle_io__rename(const char *from, const char *to) {
#ifdef _WIN32
    remove(to);
#endif
    return rename(from, to) == 0;
}

RIDDLE_IO_API riddle_io_status riddle_io_close(riddle_io_file *file) {
    if (!file) return RIDDLE_IO_BAD_ARGUMENT;
    errno = 0;
    riddle_io__after(file, fflush(file->stream) == 0 && !ferror(file->stream));
    if (file->stream != stdout) riddle_io__after(file, fclose(file->stream) == 0);
    if (!file->error && file->temporary) riddle_io__after(file, riddle_io__rename(file->temporary, file->path));
    riddle_io_status status = RIDDLE_IO_OK;
    if (file->error) status = riddle_io__fail(RIDDLE_IO_NOT_WRITTEN, file->path, strerror(file->error));
    riddle_io__forget(file->temporary, file->error != 0);
    riddle_io__release(file->path);
    riddle_io__release(file);
    return status;
}

static inline riddle_io_status riddle_io__say(riddle_io_status status, char *message, size_t size, const char *why) {
    /* a shorter buffer has its beginning */
    if (message && size && snprintf(message, size, "%s", why) < 0) *message = '\0';
    return status;
}

RIDDLE_IO_API riddle_io_status riddle_io_can_write(const char *path, char *message, size_t size) {
    char *temporary = NULL;
    if (!path) return riddle_io__say(RIDDLE_IO_BAD_ARGUMENT, message, size, "no name");
    FILE *stream = riddle_io__open_beside(path, &temporary);
    if (!stream) return riddle_io__say(RIDDLE_IO_NOT_WRITTEN, message, size, strerror(errno));
    if (stream != stdout) fclose(stream);
    riddle_io__forget(temporary, true);
    return RIDDLE_IO_OK;
}

RIDDLE_IO_API riddle_io_status riddle_io_make_folder(const char *path, char *message, size_t size) {
    if (!path || !*path) return riddle_io__say(RIDDLE_IO_BAD_ARGUMENT, message, size, "no name");
    char *trial = riddle_io__joined(path, "/", "trial");
    if (!trial) return riddle_io__say(RIDDLE_IO_NO_MEMORY, message, size, "out of memory");
    int failed = 0;
    for (char *c = trial + 1; *c && !failed; c++) {
        if (*c != '/' || c[-1] == '/') continue;
        *c = '\0';
        const int why = riddle_io__make_one_folder(trial) == 0 ? 0 : errno;
        if (why && !riddle_io__is_folder(trial)) failed = why == EEXIST ? ENOTDIR : why;
        *c = '/';
    }
    riddle_io_status status = failed ? riddle_io__say(RIDDLE_IO_NOT_WRITTEN, message, size, strerror(failed))
                                     : riddle_io_can_write(trial, message, size);
    riddle_io__release(trial);
    return status;
}

RIDDLE_IO_API const char *riddle_io_path(char *buffer, size_t size, const char *folder, const char *name) {
    if (!buffer || size == 0) return buffer;
    const int length = snprintf(buffer, size, "%s%s%s", folder ? folder : "", folder ? "/" : "", name ? name : "");
    if (length < 0 || (size_t)length >= size) buffer[0] = '\0';
    return buffer;
}

/* =============================================== >>ParaView: bodies =============================================== */

static inline riddle_io_array riddle_io__view(const char *name, int components) {
    riddle_io_array a = {name, components, 1, {NULL, NULL, NULL}, NULL, NULL};
    return a;
}

RIDDLE_IO_API riddle_io_array riddle_io_scalar(const char *name, const double *values) {
    riddle_io_array a = riddle_io__view(name, 1);
    a.data[0] = values;
    return a;
}

RIDDLE_IO_API riddle_io_array riddle_io_scalar_float(const char *name, const float *values) {
    riddle_io_array a = riddle_io__view(name, 1);
    a.floats = values;
    return a;
}

RIDDLE_IO_API riddle_io_array riddle_io_ints(const char *name, const int *values) {
    riddle_io_array a = riddle_io__view(name, 1);
    a.ints = values;
    return a;
}

RIDDLE_IO_API riddle_io_array riddle_io_vector_stride(const char *name, const double *xyz, int stride) {
    riddle_io_array a = riddle_io__view(name, 3);
    for (int k = 0; k < 3; k++) a.data[k] = xyz ? xyz + k : NULL;
    a.stride = stride;
    return a;
}

RIDDLE_IO_API riddle_io_array riddle_io_vector(const char *name, const double *xyz) {
    return riddle_io_vector_stride(name, xyz, 3);
}

RIDDLE_IO_API riddle_io_array riddle_io_vector3(const char *name, const double *x, const double *y, const double *z) {
    riddle_io_array a = riddle_io__view(name, 3);
    a.data[0] = x;
    a.data[1] = y;
    a.data[2] = z;
    return a;
}

/* ---- bytes, little-endian on any machine, through one buffer ---- */

typedef struct {
    riddle_io_file *file;
    size_t used;
    unsigned char bytes[65536];
} riddle_io__stream;

static inline void riddle_io__put(riddle_io__stream *s, uint64_t value, int bytes) {
    if (s->used + 8 > sizeof s->bytes) {
        riddle_io_write(s->file, s->bytes, s->used);
        s->used = 0;
    }
    for (int i = 0; i < bytes; i++) s->bytes[s->used++] = (unsigned char)(value >> (8 * i) & 0xFF);
}

static inline void riddle_io__put_float(riddle_io__stream *s, double value) {
    float narrow = (float)value;
    uint32_t bits;
    memcpy(&bits, &narrow, sizeof bits);
    riddle_io__put(s, bits, 4);
}

static inline uint64_t riddle_io__array_bytes(const riddle_io_array *a, int n) {
    return 4 * (uint64_t)a->components * (uint64_t)n;
}

static inline void riddle_io__put_array(riddle_io__stream *s, const riddle_io_array *a, int n) {
    riddle_io__put(s, riddle_io__array_bytes(a, n), 8);
    for (int i = 0; i < n; i++) {
        if (a->ints) riddle_io__put(s, (uint32_t)a->ints[i], 4);
        else if (a->floats) riddle_io__put_float(s, (double)a->floats[i]);
        else
            for (int k = 0; k < a->components; k++) riddle_io__put_float(s, a->data[k][(size_t)i * (size_t)a->stride]);
    }
}

static inline void riddle_io__put_ints(riddle_io__stream *s, const int *values, int n) {
    riddle_io__put(s, 4 * (uint64_t)n, 8);
    for (int i = 0; i < n; i++) riddle_io__put(s, (uint32_t)(values ? values[i] : i), 4);
}

/* ---- the XML around them; *offset counts into the appended block ---- */

static inline void riddle_io__write_escaped(riddle_io_file *file, const char *text) {
    for (; *text; text++) {
        if (*text == '&') riddle_io_print(file, "&amp;");
        else if (*text == '<') riddle_io_print(file, "&lt;");
        else if (*text == '"') riddle_io_print(file, "&quot;");
        else riddle_io_write(file, text, 1);
    }
}

static inline void riddle_io__describe(riddle_io_file *file, const riddle_io_array *a, int n, uint64_t *offset) {
    riddle_io_print(file, "<DataArray type=\"%s\" Name=\"", a->ints ? "Int32" : "Float32");
    riddle_io__write_escaped(file, a->name);
    riddle_io_print(file, "\" NumberOfComponents=\"%d\" format=\"appended\" offset=\"%llu\"/>\n", a->components,
                    (unsigned long long)*offset);
    *offset += 8 + riddle_io__array_bytes(a, n);
}

static inline void riddle_io__describe_ints(riddle_io_file *file, const char *name, int n, uint64_t *offset) {
    riddle_io_print(file, "<DataArray type=\"Int32\" Name=\"%s\" format=\"appended\" offset=\"%llu\"/>\n", name,
                    (unsigned long long)*offset);
    *offset += 8 + 4 * (uint64_t)n;
}

static inline void riddle_io__head(riddle_io_file *file, const char *type) {
    riddle_io_print(file,
                    "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" byte_order=\"LittleEndian\" "
                    "header_type=\"UInt64\">\n",
                    type);
}

static inline riddle_io__stream *riddle_io__begin_appended(riddle_io_file *file) {
    riddle_io__stream *s = (riddle_io__stream *)RIDDLE_IO_REALLOC(NULL, sizeof *s);
    if (!s) {
        riddle_io__no_memory("a ParaView file");
        return NULL;
    }
    s->file = file;
    s->used = 0;
    riddle_io_print(file, "<AppendedData encoding=\"raw\">\n_");
    return s;
}

static inline riddle_io_status riddle_io__end_appended(riddle_io__stream *s) {
    riddle_io_file *file = s->file;
    riddle_io_write(file, s->bytes, s->used);
    riddle_io__release(s);
    riddle_io_print(file, "\n</AppendedData>\n</VTKFile>\n");
    return riddle_io_close(file);
}

static inline bool riddle_io__is_whole(const riddle_io_array *a, int n) {
    if (!a->name) return false;
    if (n == 0) return true;
    if (a->floats || a->ints) return a->components == 1;
    bool whole = n > 0 && (a->components == 1 || a->components == 3);
    for (int k = 0; whole && k < a->components; k++) whole = a->data[k] != NULL;
    return whole;
}

static inline bool riddle_io__are_whole(const riddle_io_array *arrays, int n_arrays, int n) {
    bool whole = n >= 0 && n_arrays >= 0 && (arrays || n_arrays == 0);
    for (int i = 0; whole && i < n_arrays; i++) whole = riddle_io__is_whole(&arrays[i], n);
    return whole;
}

/* Returns whether every cell has corners and all corners are points: a reader would crash otherwise. */
static inline bool riddle_io__are_cells(int n_points, int n_cells, const int *ends, const int *corners) {
    if (n_cells < 0 || (n_cells > 0 && (!ends || !corners))) return false;
    for (int c = 0; c < n_cells; c++)
        if (ends[c] <= (c ? ends[c - 1] : 0)) return false;
    for (int i = 0; n_cells > 0 && i < ends[n_cells - 1]; i++)
        if (corners[i] < 0 || corners[i] >= n_points) return false;
    return true;
}

static inline riddle_io_status riddle_io__polydata(const char *folder, const char *name, const char *cell_kind, int n,
                                                   riddle_io_array position, int n_cells, const int *ends,
                                                   const int *corners, const riddle_io_array *arrays, int n_arrays) {
    bool vertices = strcmp(cell_kind, "Verts") == 0;
    if (!riddle_io__are_whole(arrays, n_arrays, n) || !riddle_io__are_whole(&position, 1, n) ||
        position.components != 3)
        return riddle_io__fail(RIDDLE_IO_BAD_ARGUMENT, name,
                               "an array is missing, or the number of points is negative");
    if (!vertices && !riddle_io__are_cells(n, n_cells, ends, corners))
        return riddle_io__fail(RIDDLE_IO_BAD_ARGUMENT, name,
                               "the ends of the cells do not rise, or a corner is no point");
    int n_corners = vertices ? n : n_cells > 0 ? ends[n_cells - 1] : 0;
    riddle_io_file *file = riddle_io_open(folder, name);
    if (!file) return RIDDLE_IO_NOT_WRITTEN;
    uint64_t offset = 0;
    riddle_io__head(file, "PolyData");
    riddle_io_print(file,
                    "<PolyData>\n<Piece NumberOfPoints=\"%d\" NumberOfVerts=\"%d\" NumberOfLines=\"%d\" "
                    "NumberOfStrips=\"0\" NumberOfPolys=\"%d\">\n",
                    n, vertices ? n : 0, strcmp(cell_kind, "Lines") == 0 ? n_cells : 0,
                    strcmp(cell_kind, "Polys") == 0 ? n_cells : 0);
    riddle_io_print(file, "<PointData>\n");
    for (int i = 0; i < n_arrays; i++) riddle_io__describe(file, &arrays[i], n, &offset);
    riddle_io_print(file, "</PointData>\n<Points>\n");
    riddle_io__describe(file, &position, n, &offset);
    riddle_io_print(file, "</Points>\n<%s>\n", cell_kind);
    riddle_io__describe_ints(file, "connectivity", n_corners, &offset);
    riddle_io__describe_ints(file, "offsets", n_cells, &offset);
    riddle_io_print(file, "</%s>\n</Piece>\n</PolyData>\n", cell_kind);
    riddle_io__stream *s = riddle_io__begin_appended(file);
    if (!s) {
        riddle_io_discard(file);
        return RIDDLE_IO_NO_MEMORY;
    }
    for (int i = 0; i < n_arrays; i++) riddle_io__put_array(s, &arrays[i], n);
    riddle_io__put_array(s, &position, n);
    riddle_io__put_ints(s, vertices ? NULL : corners, n_corners);
    if (vertices) {
        riddle_io__put(s, 4 * (uint64_t)n, 8);
        for (int i = 0; i < n; i++) riddle_io__put(s, (uint32_t)(i + 1), 4);
    } else {
        riddle_io__put_ints(s, ends, n_cells);
    }
    return riddle_io__end_appended(s);
}

RIDDLE_IO_API riddle_io_status riddle_io_points(const char *folder, const char *name, int n, riddle_io_array position,
                                                const riddle_io_array *arrays, int n_arrays) {
    return riddle_io__polydata(folder, name, "Verts", n, position, n, NULL, NULL, arrays, n_arrays);
}

RIDDLE_IO_API riddle_io_status riddle_io_lines(const char *folder, const char *name, int n_points,
                                               riddle_io_array position, int n_cells, const int *ends,
                                               const int *corners, const riddle_io_array *arrays, int n_arrays) {
    return riddle_io__polydata(folder, name, "Lines", n_points, position, n_cells, ends, corners, arrays, n_arrays);
}

RIDDLE_IO_API riddle_io_status riddle_io_polygons(const char *folder, const char *name, int n_points,
                                                  riddle_io_array position, int n_cells, const int *ends,
                                                  const int *corners, const riddle_io_array *arrays, int n_arrays) {
    return riddle_io__polydata(folder, name, "Polys", n_points, position, n_cells, ends, corners, arrays, n_arrays);
}

RIDDLE_IO_API riddle_io_status riddle_io_cells(const char *folder, const char *name, const int size[3],
                                               const double origin[3], const double spacing[3],
                                               const riddle_io_array *arrays, int n_arrays) {
    double cells = size ? (double)size[0] * size[1] * size[2] : 0.0;
    if (!(size && origin && spacing && size[0] > 0 && size[1] > 0 && size[2] > 0 && cells < 2147483647.0))
        return riddle_io__fail(RIDDLE_IO_BAD_ARGUMENT, name, "a grid of no cells, or of 2^31 or more");
    int n = size[0] * size[1] * size[2];
    if (!riddle_io__are_whole(arrays, n_arrays, n))
        return riddle_io__fail(RIDDLE_IO_BAD_ARGUMENT, name, "an array is missing");
    riddle_io_file *file = riddle_io_open(folder, name);
    if (!file) return RIDDLE_IO_NOT_WRITTEN;
    uint64_t offset = 0;
    riddle_io__head(file, "ImageData");
    riddle_io_print(file,
                    "<ImageData WholeExtent=\"0 %d 0 %d 0 %d\" Origin=\"%.9g %.9g %.9g\" Spacing=\"%.9g %.9g %.9g\">\n",
                    size[0], size[1], size[2], origin[0], origin[1], origin[2], spacing[0], spacing[1], spacing[2]);
    riddle_io_print(file, "<Piece Extent=\"0 %d 0 %d 0 %d\">\n<CellData>\n", size[0], size[1], size[2]);
    for (int i = 0; i < n_arrays; i++) riddle_io__describe(file, &arrays[i], n, &offset);
    riddle_io_print(file, "</CellData>\n</Piece>\n</ImageData>\n");
    riddle_io__stream *s = riddle_io__begin_appended(file);
    if (!s) {
        riddle_io_discard(file);
        return RIDDLE_IO_NO_MEMORY;
    }
    for (int i = 0; i < n_arrays; i++) riddle_io__put_array(s, &arrays[i], n);
    return riddle_io__end_appended(s);
}

/* ---- time series ---- */

enum { RIDDLE_IO__NAMED, RIDDLE_IO__THERE, RIDDLE_IO__DROPPED };

typedef struct {
    double time;
    char extension[8];
    int state; /* named: its file has not been seen yet */
} riddle_io__frame;

struct riddle_io_series {
    char *folder, *stem; /* folder may be NULL */
    riddle_io__frame *frames;
    int n, capacity;
    char current[RIDDLE_IO_SERIES_BYTES + 32]; /* "STEM_2147483647.seven77"; empty: no frame to drop */
};

static inline char *riddle_io__copy(const char *text, size_t length) {
    char *c = (char *)RIDDLE_IO_REALLOC(NULL, length + 1);
    if (!c) return NULL;
    memcpy(c, text, length);
    c[length] = '\0';
    return c;
}

static inline void riddle_io__frame_name(const riddle_io_series *series, int i, char *text, size_t size) {
    /* It fits: the lengths were checked. */
    snprintf(text, size, "%s_%04d.%s", series->stem, i, series->frames[i].extension);
}

/* Notes which of the named frames are there now. The others are looked for again: a caller may write them late. */
static inline bool riddle_io__look_for_frames(riddle_io_series *series) {
    char name[sizeof series->current];
    struct stat info;
    for (int i = 0; i < series->n; i++) {
        if (series->frames[i].state != RIDDLE_IO__NAMED) continue;
        riddle_io__frame_name(series, i, name, sizeof name);
        char *path = riddle_io__joined(series->folder ? series->folder : "", series->folder ? "/" : "", name);
        if (!path) return false;
        if (stat(path, &info) == 0 && !S_ISDIR(info.st_mode)) series->frames[i].state = RIDDLE_IO__THERE;
        riddle_io__release(path);
    }
    return true;
}

static inline riddle_io_status riddle_io__write_index(riddle_io_series *series) {
    char name[sizeof series->current];
    const char *slash = riddle_io__last_slash(series->stem);
    /* Readers look for a frame beside the index. */
    const size_t folder = slash ? (size_t)(slash - series->stem) + 1 : 0;
    if (!riddle_io__look_for_frames(series)) return riddle_io__no_memory(series->stem);
    snprintf(name, sizeof name, "%s.pvd", series->stem);
    riddle_io_file *file = riddle_io_open(series->folder, name);
    if (!file) return RIDDLE_IO_NOT_WRITTEN;
    riddle_io_print(file, "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
                          "byte_order=\"LittleEndian\">\n<Collection>\n");
    for (int i = 0; i < series->n; i++) {
        if (series->frames[i].state != RIDDLE_IO__THERE) continue;
        riddle_io__frame_name(series, i, name, sizeof name);
        riddle_io_print(file, "<DataSet timestep=\"%.9g\" part=\"0\" file=\"", series->frames[i].time);
        riddle_io__write_escaped(file, name + folder);
        riddle_io_print(file, "\"/>\n");
    }
    riddle_io_print(file, "</Collection>\n</VTKFile>\n");
    return riddle_io_close(file);
}

static inline void riddle_io__end_series(riddle_io_series *series) {
    riddle_io__release(series->folder);
    riddle_io__release(series->stem);
    riddle_io__release(series->frames);
    riddle_io__release(series);
}

RIDDLE_IO_API riddle_io_series *riddle_io_series_open(const char *folder, const char *name) {
    if (!name) {
        riddle_io__fail(RIDDLE_IO_BAD_ARGUMENT, folder, "a series without a name");
        return NULL;
    }
    size_t length = strlen(name);
    if (length > 4 && strcmp(name + length - 4, ".pvd") == 0) length -= 4;
    if (length > RIDDLE_IO_SERIES_BYTES) {
        riddle_io__fail(RIDDLE_IO_BAD_ARGUMENT, name, "the name of a series has at most 1000 bytes");
        return NULL;
    }
    riddle_io_series *series = (riddle_io_series *)riddle_io__zeroed(sizeof *series);
    if (series) {
        series->folder = folder ? riddle_io__copy(folder, strlen(folder)) : NULL;
        series->stem = riddle_io__copy(name, length);
    }
    if (!series || (folder && !series->folder) || !series->stem) {
        riddle_io__no_memory(name);
        if (series) riddle_io__end_series(series);
        return NULL;
    }
    return series;
}

RIDDLE_IO_API const char *riddle_io_series_name_as(riddle_io_series *series, double time, const char *extension) {
    if (!series || !extension) return NULL;
    series->current[0] = '\0';
    if (series->n > 0) riddle_io__write_index(series);
    if (!*extension || strlen(extension) >= sizeof series->frames->extension) {
        riddle_io__fail(RIDDLE_IO_BAD_ARGUMENT, series->stem, "the extension of a frame has 1 to 7 bytes");
        return NULL;
    }
    if (series->n == series->capacity) {
        const int capacity = 2 * series->capacity + 64;
        riddle_io__frame *frames =
            (riddle_io__frame *)RIDDLE_IO_REALLOC(series->frames, (size_t)capacity * sizeof *frames);
        if (!frames) {
            riddle_io__no_memory(series->stem);
            return NULL;
        }
        series->frames = frames;
        series->capacity = capacity;
    }
    riddle_io__frame *frame = &series->frames[series->n];
    frame->time = time;
    frame->state = RIDDLE_IO__NAMED;
    memcpy(frame->extension, extension, strlen(extension) + 1);
    riddle_io__frame_name(series, series->n++, series->current, sizeof series->current);
    return series->current;
}

RIDDLE_IO_API const char *riddle_io_series_name(riddle_io_series *series, double time) {
    return riddle_io_series_name_as(series, time, "vtp");
}

RIDDLE_IO_API void riddle_io_series_drop(riddle_io_series *series) {
    if (series && series->current[0]) series->frames[series->n - 1].state = RIDDLE_IO__DROPPED;
}

RIDDLE_IO_API riddle_io_status riddle_io_series_close(riddle_io_series *series) {
    if (!series) return RIDDLE_IO_BAD_ARGUMENT;
    riddle_io_status status = riddle_io__write_index(series);
    riddle_io__end_series(series);
    return status;
}

/* ========================================== >>tables and progress: bodies ========================================= */

static inline void riddle_io__append(riddle_io_table *t, const char *text, size_t length) {
    if (t->used + length + 1 > t->capacity) {
        size_t capacity = 2 * t->capacity + length + 256;
        char *larger = (char *)RIDDLE_IO_REALLOC(t->text, capacity);
        if (!larger) {
            riddle_io__no_memory("a table");
            return;
        }
        t->text = larger;
        t->capacity = capacity;
    }
    memcpy(t->text + t->used, text, length);
    t->text[t->used + length] = '\0';
    t->used += length + 1;
    t->cells++;
}

RIDDLE_IO_API riddle_io_table riddle_io_table_begin(const char *header) {
    riddle_io_table t = {0, 0, NULL, 0, 0};
    for (const char *at = header ? header : ""; t.columns < RIDDLE_IO_TABLE_COLUMNS; t.columns++) {
        size_t length = strcspn(at, "|");
        riddle_io__append(&t, at, length);
        if (!at[length]) {
            t.columns++;
            break;
        }
        at += length + 1;
    }
    return t;
}

RIDDLE_IO_API void riddle_io_table_cell(riddle_io_table *t, const char *format, ...) {
    char cell[400];
    va_list arguments;
    if (!t || !format) return;
    va_start(arguments, format);
    if (vsnprintf(cell, sizeof cell, format, arguments) < 0) cell[0] = '\0';
    va_end(arguments);
    riddle_io__append(t, cell, strlen(cell));
}

static inline bool riddle_io__is_number(const char *text) {
    char *end;
    strtod(text, &end);
    return end != text || strcmp(text, "-") == 0 || !*text;
}

static inline void riddle_io__rule(const int *width, int columns, FILE *stream) {
    for (int k = 0; k < columns; k++) {
        if (k) fputs("  ", stream);
        for (int n = 0; n < width[k]; n++) fputc('-', stream);
    }
    fputc('\n', stream);
}

static inline void riddle_io__print_table(const riddle_io_table *t, FILE *stream) {
    int width[RIDDLE_IO_TABLE_COLUMNS] = {0};
    bool left[RIDDLE_IO_TABLE_COLUMNS] = {false};
    const char *at = t->text;
    for (int i = 0; i < t->cells; i++, at += strlen(at) + 1) {
        int column = i % t->columns, n = riddle_io__letters_of(at);
        if (n > width[column]) width[column] = n;
        if (i >= t->columns && !riddle_io__is_number(at)) left[column] = true;
    }
    at = t->text;
    for (int i = 0; i < t->cells; i++, at += strlen(at) + 1) {
        int column = i % t->columns, pad = width[column] - riddle_io__letters_of(at);
        bool last = column == t->columns - 1;
        if (column) fputs(last && !*at ? "" : "  ", stream); /* no blanks at the end of a line */
        fprintf(stream, "%*s%s%*s", left[column] || (last && !*at) ? 0 : pad, "", at, left[column] && !last ? pad : 0,
                "");
        if (last || i == t->cells - 1) fputc('\n', stream);
        if (i == t->columns - 1) riddle_io__rule(width, t->columns, stream);
    }
    fflush(stream);
}

RIDDLE_IO_API void riddle_io_table_end(riddle_io_table *t, FILE *stream) {
    if (!t) return;
    if (stream && t->text) riddle_io__print_table(t, stream);
    riddle_io__release(t->text);
    t->text = NULL;
    t->cells = 0;
    t->used = t->capacity = 0;
}

RIDDLE_IO_API double riddle_io_seconds(void) {
#ifdef _WIN32
    struct _timeb now;
    _ftime(&now);
    return (double)now.time + 1e-3 * (double)now.millitm;
#else
    struct timeval now;
    gettimeofday(&now, NULL);
    return (double)now.tv_sec + 1e-6 * (double)now.tv_usec;
#endif
}

static inline void riddle_io__clock_text(double seconds, char *text, size_t size) {
    if (!(seconds >= 0.0) || seconds > 360000.0) snprintf(text, size, "--:--");
    else if (seconds < 3600.0) snprintf(text, size, "%d:%02d", (int)seconds / 60, (int)seconds % 60);
    else snprintf(text, size, "%d:%02d:%02d", (int)seconds / 3600, (int)seconds / 60 % 60, (int)seconds % 60);
}

static inline void riddle_io__draw_bar(riddle_io_progress *bar, double now) {
    double share = bar->total > 0.0 ? bar->done / bar->total : 1.0;
    if (!(share > 0.0)) share = 0.0;
    if (share > 1.0) share = 1.0;
    double elapsed = now - bar->began;
    char left[32];
    riddle_io__clock_text(share > 0.0 ? elapsed * (1.0 - share) / share : -1.0, left, sizeof left);
    if (bar->terminal) {
        char cells[31];
        int full = (int)(30.0 * share);
        for (int i = 0; i < 30; i++) cells[i] = i < full ? '#' : '.';
        cells[30] = '\0';
        fprintf(stderr, "\r%-24.24s [%s] %3d %%  %s left \033[K", bar->what, cells, (int)(100.0 * share), left);
        fflush(stderr);
    } else if ((int)(4.0 * share) > bar->quarter && share < 1.0) {
        bar->quarter = (int)(4.0 * share);
        fprintf(stderr, "%s: %d %%, %s left\n", bar->what, 25 * bar->quarter, left);
    }
    bar->printed = now;
}

RIDDLE_IO_API void riddle_io_progress_begin(riddle_io_progress *bar, const char *what, double total) {
    if (!bar) return;
    bar->what = what ? what : "";
    bar->total = total;
    bar->done = 0.0;
    bar->began = riddle_io_seconds();
    bar->printed = -HUGE_VAL;
    bar->quarter = 0;
#ifdef _WIN32
    bar->terminal = _isatty(2) != 0;
#else
    bar->terminal = isatty(2) == 1;
#endif
    bar->active = 1;
}

RIDDLE_IO_API void riddle_io_progress_update(riddle_io_progress *bar, double done) {
    if (!bar || !bar->active) return;
    bar->done = done;
    double now = riddle_io_seconds();
    if (now - bar->printed >= 0.1) riddle_io__draw_bar(bar, now);
}

RIDDLE_IO_API void riddle_io_progress_end(riddle_io_progress *bar, const char *how) {
    if (!bar || !bar->active) return;
    if (bar->terminal) fprintf(stderr, "\r\033[K");
    fprintf(stderr, "%s: %s %.1f s\n", bar->what, how ? how : "done in", riddle_io_seconds() - bar->began);
    bar->active = 0;
}

#endif /* RIDDLE_IO__BODIES */

#ifdef __cplusplus
}
#endif
#endif
