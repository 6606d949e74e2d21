/* riddle_io.h: what a simulation writes: ParaView files, SVG figures, CSV, tables, a progress bar. Every file is whole or absent.

   #include "riddle_io.h"

   int main(void) {
       double time[] = {0, 1, 2}, height[] = {1.0, 0.5, 0.8}, xyz[] = {0, 0, 0, 0, 0, 0.01}, radius[] = {0.005, 0.004};
       riddle_io_plot *figure = riddle_io_plot_new("A ball that jumps", 1, 1);
       riddle_io_plot_panel(figure, 0, 0, "time [s]", "height [m]");
       riddle_io_plot_line(figure, "ball", time, height, 3);
       riddle_io_plot_write(figure, NULL, "/dev/null");                                  // folder and file: "out", "ball.svg"
       riddle_io_array of_points[] = {riddle_io_scalar("radius_m", radius)};
       return riddle_io_points(NULL, "/dev/null", 2, riddle_io_vector("position", xyz), of_points, 1);
   }

   Files    riddle_io_open, _print, _write, _row, _close: a file is written under a temporary name beside its own and renamed when it is
            closed; if anything failed, nothing is left and an older file of that name stays. Folders that are missing are made.
            A device and a pipe are written directly; "-" is standard output.
   ParaView .vtp points, lines, polygons; .vti regular grids (binary, little-endian, float32, int32); .pvd index of a time series.
            The format: VTK File Formats, Kitware.
   Figures  SVG 1.1: panels in rows and columns; lines, points, bands, error bars, bars, heat maps; axes, units, a legend that keeps off
            the data. Colours: Okabe & Ito (2008); van der Walt & Smith (2015).
   Locale   numbers have a decimal point, whatever locale the host has set (tables and the progress bar, for people, have the host's).
   Units    the caller's: labels and names are written as they are given. Lengths of figures are in points (1/72 inch).
   Errors   a function that fails hands one line ("out/a.csv: No space left on device") to RIDDLE_IO_FAIL, returns its status, and
            leaves nothing half written. Every function takes the NULL that another returned and does nothing.
   Hooks    macros, to be set before the inclusion (of the one file with the bodies, where there is one):
            RIDDLE_IO_FAIL(line)                          what to do with an error's line; default: print it on stderr
            RIDDLE_IO_REALLOC(old, size), RIDDLE_IO_FREE(old)   memory; default: realloc, free
            RIDDLE_IO_CREATED(name), RIDDLE_IO_GONE(name) a temporary file has come into being or has gone, for hosts that clean up
                                                          when they leave early; default: nothing
   Memory   an object lives from its _open or _new to its _close, _write, _end or _free. Data given to a figure are copied.
   Threads  no state but the caller's objects: one object is used by one thread at a time.
   Bits     the same input gives the same file with the same C library.
   Linking  every function is static inline. For one shared copy: #define RIDDLE_IO_API extern before every inclusion, and
            RIDDLE_IO_IMPLEMENTATION as well in one file.
   Not here: reading. The physics headers know nothing of this one: it takes plain arrays. */
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

/* ========================================================== status ========================================================== */

#define RIDDLE_IO_STATUSES(X)                                                                                                              \
    X(RIDDLE_IO_OK, "ok")                                                                                                                  \
    X(RIDDLE_IO_BAD_ARGUMENT, "an argument is NULL or out of its range")                                                                   \
    X(RIDDLE_IO_NO_MEMORY, "out of memory")                                                                                                \
    X(RIDDLE_IO_NOT_WRITTEN, "a file or folder could not be written")

#define RIDDLE_IO__NAME(name, text) name,
typedef enum riddle_io_status { RIDDLE_IO_STATUSES(RIDDLE_IO__NAME) RIDDLE_IO_STATUS_COUNT } riddle_io_status;
#undef RIDDLE_IO__NAME

RIDDLE_IO_API const char *riddle_io_status_text(riddle_io_status status); /* never NULL */

/* ========================================================== files =========================================================== */

typedef struct riddle_io_file riddle_io_file;

/* Begins a file. folder may be NULL: name is then a whole path. Missing folders are made. NULL after an error. */
RIDDLE_IO_API riddle_io_file *riddle_io_open(const char *folder, const char *name);
RIDDLE_IO_API riddle_io_status riddle_io_print(riddle_io_file *file, const char *format, ...) RIDDLE_IO__PRINTF(2, 3);
RIDDLE_IO_API riddle_io_status riddle_io_write(riddle_io_file *file, const void *bytes, size_t size);
/* Writes one row of CSV: %.17g with commas between, an empty cell for a number that is not finite. */
RIDDLE_IO_API riddle_io_status riddle_io_row(riddle_io_file *file, const double *values, int n);
/* Closes the file. RIDDLE_IO_OK: the file exists under its name. Otherwise nothing is left, whichever of the calls above failed. Frees the
   object. */
RIDDLE_IO_API riddle_io_status riddle_io_close(riddle_io_file *file);
RIDDLE_IO_API void riddle_io_discard(riddle_io_file *file); /* closes it and leaves nothing */

/* Makes a folder and its parents, and checks that it can be written to. message (may be NULL): the reason of a failure. */
RIDDLE_IO_API riddle_io_status riddle_io_make_folder(const char *path, char *message, size_t size);
/* Checks whether a file of that name could be written now; its folder must exist. message: the reason of a failure. */
RIDDLE_IO_API riddle_io_status riddle_io_can_write(const char *path, char *message, size_t size);
/* Writes "folder/name" to buffer, and returns buffer. folder may be NULL. Where it does not fit, buffer is empty: no other file's name. */
RIDDLE_IO_API const char *riddle_io_path(char *buffer, size_t size, const char *folder, const char *name);

/* ========================================================= ParaView ========================================================= */

/* A view of the caller's array, made by the functions below; nothing is copied before writing. */
typedef struct riddle_io_array {
    const char *name; /* with the unit where there is one: "velocity_m_s" */
    int components;   /* 1 or 3 */
    int stride;       /* between neighbours in data[k] */
    const double *data[3];
    const float *floats; /* one of data, floats, ints is not NULL */
    const int *ints;
} riddle_io_array;

RIDDLE_IO_API riddle_io_array riddle_io_scalar(const char *name, const double *values);                               /* [n] */
RIDDLE_IO_API riddle_io_array riddle_io_scalar_float(const char *name, const float *values);                          /* [n] */
RIDDLE_IO_API riddle_io_array riddle_io_ints(const char *name, const int *values);                                    /* [n] */
RIDDLE_IO_API riddle_io_array riddle_io_vector(const char *name, const double *xyz);                                  /* [n][3] */
RIDDLE_IO_API riddle_io_array riddle_io_vector3(const char *name, const double *x, const double *y, const double *z); /* three of [n] */
RIDDLE_IO_API riddle_io_array riddle_io_vector_stride(const char *name, const double *xyz, int stride); /* xyz + i * stride [doubles] */

/* Writes n points with their arrays, one vertex each (Glyph or Point Gaussian in ParaView). An array is written as often as position:
   [n]. */
RIDDLE_IO_API riddle_io_status riddle_io_points(const char *folder, const char *name, int n, riddle_io_array position,
                                                const riddle_io_array *arrays, int n_arrays);
/* Writes lines or polygons: cell c joins corners[ends[c-1]] .. corners[ends[c]-1] (0-based points; ends[-1] is 0). Arrays belong to the
   points. */
RIDDLE_IO_API riddle_io_status riddle_io_lines(const char *folder, const char *name, int n_points, riddle_io_array position, int n_cells,
                                               const int *ends, const int *corners, const riddle_io_array *arrays, int n_arrays);
RIDDLE_IO_API riddle_io_status riddle_io_polygons(const char *folder, const char *name, int n_points, riddle_io_array position, int n_cells,
                                                  const int *ends, const int *corners, const riddle_io_array *arrays, int n_arrays);
/* Writes a regular grid of size[0] x size[1] x size[2] cells, first index fastest; origin and spacing [m]. Arrays belong to the cells. */
RIDDLE_IO_API riddle_io_status riddle_io_cells(const char *folder, const char *name, const int size[3], const double origin[3],
                                               const double spacing[3], const riddle_io_array *arrays, int n_arrays);

/* The index of a time series: grains.pvd lists grains_0000.vtp, ... and is written anew, whole, at each frame. What moves differently
   (grains, walls) is a series of its own:
       riddle_io_points("out", riddle_io_series_name(series, time), n, position, arrays, n_arrays);
   folder as in riddle_io_open; name: with or without ".pvd", of RIDDLE_IO_SERIES_BYTES at most; a folder in it is made. NULL after an
   error. */
enum { RIDDLE_IO_SERIES_BYTES = 1000 };
typedef struct riddle_io_series riddle_io_series;
RIDDLE_IO_API riddle_io_series *riddle_io_series_open(const char *folder, const char *name);
/* Returns the next frame's file name (below the folder of the series), valid until the next call; the index lists it as soon as the file
   is there. NULL after an error. extension: "vti", not "vtp"; 1 to 7 bytes. */
RIDDLE_IO_API const char *riddle_io_series_name(riddle_io_series *series, double time);
RIDDLE_IO_API const char *riddle_io_series_name_as(riddle_io_series *series, double time, const char *extension);
/* Leaves the frame just named out of the index: it was not written, and a file of that name is an older one. Its number is not used
   again. */
RIDDLE_IO_API void riddle_io_series_drop(riddle_io_series *series);
RIDDLE_IO_API riddle_io_status riddle_io_series_close(riddle_io_series *series);

/* ========================================================== figures ========================================================= */

/* Values that are not finite (or not positive on a log axis) are left out and break a line. Text is UTF-8 and is escaped. Panels without a
   call stay empty. A series with the label NULL or "" is not in the legend. */
typedef struct riddle_io_plot riddle_io_plot;

RIDDLE_IO_API riddle_io_plot *riddle_io_plot_new(const char *title, int rows, int columns); /* title may be NULL; 1 to 6 rows and columns */
RIDDLE_IO_API void riddle_io_plot_panel_size(riddle_io_plot *p, double width, double height); /* of each; default 540 x 360 for one panel */
RIDDLE_IO_API riddle_io_status riddle_io_plot_write(riddle_io_plot *p, const char *folder, const char *name); /* always frees the figure */
RIDDLE_IO_API void riddle_io_plot_free(riddle_io_plot *p);                                                    /* instead of writing it */

/* Chooses the panel that the following calls work on. */
RIDDLE_IO_API void riddle_io_plot_panel(riddle_io_plot *p, int row, int column, const char *x_label, const char *y_label);
RIDDLE_IO_API void riddle_io_plot_title(riddle_io_plot *p, const char *title); /* of the panel */
RIDDLE_IO_API void riddle_io_plot_log_x(riddle_io_plot *p);
RIDDLE_IO_API void riddle_io_plot_log_y(riddle_io_plot *p);
RIDDLE_IO_API void riddle_io_plot_range_x(riddle_io_plot *p, double low, double high); /* default: the data with a small margin */
RIDDLE_IO_API void riddle_io_plot_range_y(riddle_io_plot *p, double low, double high);
RIDDLE_IO_API void riddle_io_plot_equal(riddle_io_plot *p); /* same length for one unit on both axes */
RIDDLE_IO_API void
riddle_io_plot_legend_outside(riddle_io_plot *p); /* right of the panel; default: inside where no data are, else outside */

/* Add a series of n points. Each takes the next colour. */
RIDDLE_IO_API void riddle_io_plot_line(riddle_io_plot *p, const char *label, const double *x, const double *y, int n);
RIDDLE_IO_API void riddle_io_plot_points(riddle_io_plot *p, const char *label, const double *x, const double *y, int n);
RIDDLE_IO_API void riddle_io_plot_band(riddle_io_plot *p, const char *label, const double *x, const double *low, const double *high, int n);
RIDDLE_IO_API void riddle_io_plot_error_bars(riddle_io_plot *p, const char *label, const double *x, const double *y,
                                             const double *plus_minus, int n);
/* Adds shaded discs, for spheres to scale: x, y and radius in the axes' unit; with riddle_io_plot_equal. They are drawn in the given
   order. */
RIDDLE_IO_API void riddle_io_plot_discs(riddle_io_plot *p, const char *label, const double *x, const double *y, const double *radius,
                                        int n);
/* Adds bars beside each other, one group for each name; call again for the next series of the same groups. */
RIDDLE_IO_API void riddle_io_plot_bars(riddle_io_plot *p, const char *label, const char *const *names, const double *values, int n);
/* Adds a heat map of values[row][column], row 0 at the bottom, between the given corners, and a colour bar with its label at the right. */
RIDDLE_IO_API void riddle_io_plot_heat(riddle_io_plot *p, const char *label, const double *values, int columns, int rows, double x0,
                                       double x1, double y0, double y1);
/* Sets the range of the colours of the heat map just added; default: that of its values. To compare panels. */
RIDDLE_IO_API void riddle_io_plot_heat_range(riddle_io_plot *p, double low, double high);

/* The appearance of the series just added. */
enum {
    RIDDLE_IO_DASHED = 1,
    RIDDLE_IO_DOTTED = 2,
    RIDDLE_IO_MARKED = 4,
    RIDDLE_IO_THIN = 8,
    RIDDLE_IO_FAINT = 16,
    RIDDLE_IO_STEPS = 32,
    RIDDLE_IO_NO_LINE = 64
};
enum { RIDDLE_IO_NEXT = -1, RIDDLE_IO_SAME = -2, RIDDLE_IO_GREY = -3, RIDDLE_IO_BLACK = -4 }; /* colours; 0 .. 7 from the palette */
RIDDLE_IO_API void riddle_io_plot_style(riddle_io_plot *p, int flags, int colour);

/* Draw reference lines over the whole panel, and text at a place in data coordinates (or at a share 0..1 of the panel). */
RIDDLE_IO_API void riddle_io_plot_horizontal(riddle_io_plot *p, const char *label, double y);
RIDDLE_IO_API void riddle_io_plot_vertical(riddle_io_plot *p, const char *label, double x);
RIDDLE_IO_API void riddle_io_plot_text(riddle_io_plot *p, double x, double y, const char *text);
RIDDLE_IO_API void riddle_io_plot_text_share(riddle_io_plot *p, double x_share, double y_share, const char *text);

/* ==================================================== tables and progress =================================================== */

/* An aligned table of plain text.
       riddle_io_table t = riddle_io_table_begin("time [s]|retained small|retained near-mesh");
       riddle_io_table_cell(&t, "%.1f", time);  riddle_io_table_cell(&t, "%.3f", small);  ...     // cells run on, row by row
       riddle_io_table_end(&t, stdout); */
enum { RIDDLE_IO_TABLE_COLUMNS = 24 };
typedef struct riddle_io_table {
    int columns;
    int cells;  /* so far, header included */
    char *text; /* the cells, each ended by 0 */
    size_t used, capacity;
} riddle_io_table;
RIDDLE_IO_API riddle_io_table riddle_io_table_begin(const char *header); /* at most RIDDLE_IO_TABLE_COLUMNS names between '|' */
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
RIDDLE_IO_API void riddle_io_progress_update(riddle_io_progress *bar, double done);  /* cheap: at most 10 prints a second; one clock read */
RIDDLE_IO_API void riddle_io_progress_end(riddle_io_progress *bar, const char *how); /* "what: how 3.2 s"; how NULL: "done in" */
RIDDLE_IO_API double riddle_io_seconds(void);                                        /* wall clock [s], origin arbitrary */

#ifdef RIDDLE_IO__BODIES

/* ====================================================== >>files: bodies ===================================================== */

#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
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

RIDDLE_IO_API const char *riddle_io_status_text(riddle_io_status status) {
#define RIDDLE_IO__TEXT(name, text)                                                                                                        \
    case name: return text;
    switch (status) {
        RIDDLE_IO_STATUSES(RIDDLE_IO__TEXT)
    case RIDDLE_IO_STATUS_COUNT: break;
    }
#undef RIDDLE_IO__TEXT
    return "unknown status";
}

/* Hands on "what: why" and returns the status. what comes from outside: control characters become '?'. */
static inline riddle_io_status riddle_io__fail(riddle_io_status status, const char *what, const char *why) {
    char line[1000];
    const size_t length = what ? strlen(what) : 0, room = 800; /* of a longer path the end: the reason must fit in too */
    snprintf(line, sizeof line, "%s%.800s: %s", length > room ? "..." : "", what ? what + (length > room ? length - room : 0) : "", why);
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

static inline char *riddle_io__joined(const char *a, const char *between, const char *b) {
    size_t size = strlen(a) + strlen(between) + strlen(b) + 1;
    char *text = (char *)RIDDLE_IO_REALLOC(NULL, size);
    if (text) snprintf(text, size, "%s%s%s", a, between, b);
    return text;
}

/* Puts a decimal point into a number that the C library has written: a host may have set a locale with a comma. */
static inline void riddle_io__use_point(char *number) {
    const char *mark = localeconv()->decimal_point;
    char *at = *mark ? strstr(number, mark) : NULL;
    if (!at || strcmp(mark, ".") == 0) return;
    *at = '.';
    memmove(at + 1, at + strlen(mark), strlen(at + strlen(mark)) + 1);
}

/* Copies a conversion such as "%-*.3lg" of a format to `spec`, with numbers in place of its stars. Returns what follows it. */
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

static inline bool riddle_io__is_standard_output(const char *path) { return strcmp(path, "-") == 0 || strcmp(path, "/dev/stdout") == 0; }

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
    if (riddle_io__is_standard_output(path)) return stdout; /* where it is redirected to a file, that file must not be replaced */
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

/* Returns a path whose links are resolved, so that a link stays one and its target is replaced; NULL where there is nothing yet. */
static inline char *riddle_io__resolved(const char *path) {
#if !defined(_WIN32) && (defined(_DEFAULT_SOURCE) || defined(_XOPEN_SOURCE) || defined(__APPLE__)) /* else it is not declared */
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

/* Makes what is missing of the folders above a file. Returns errno of the first one that could not be made, or 0. */
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
    bool worked = point ? vfprintf(file->stream, format, arguments) >= 0 : riddle_io__print(file->stream, format, &arguments);
    va_end(arguments);
    return riddle_io__after(file, worked);
}

RIDDLE_IO_API riddle_io_status riddle_io_row(riddle_io_file *file, const double *values, int n) {
    if (!file || (!values && n > 0)) return RIDDLE_IO_BAD_ARGUMENT;
    for (int i = 0; i < n; i++) {
        if (i) riddle_io_print(file, ",");
        if (values[i] - values[i] == 0.0) riddle_io_print(file, "%.17g", values[i]);
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
    if (message && size && snprintf(message, size, "%s", why) < 0) *message = '\0'; /* a shorter buffer has its beginning */
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
    riddle_io_status status =
        failed ? riddle_io__say(RIDDLE_IO_NOT_WRITTEN, message, size, strerror(failed)) : riddle_io_can_write(trial, message, size);
    riddle_io__release(trial);
    return status;
}

RIDDLE_IO_API const char *riddle_io_path(char *buffer, size_t size, const char *folder, const char *name) {
    if (!buffer || size == 0) return buffer;
    const int length = snprintf(buffer, size, "%s%s%s", folder ? folder : "", folder ? "/" : "", name ? name : "");
    if (length < 0 || (size_t)length >= size) buffer[0] = '\0';
    return buffer;
}

/* ================================================== >>ParaView: bodies ================================================== */

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

RIDDLE_IO_API riddle_io_array riddle_io_vector(const char *name, const double *xyz) { return riddle_io_vector_stride(name, xyz, 3); }

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

static inline uint64_t riddle_io__array_bytes(const riddle_io_array *a, int n) { return 4 * (uint64_t)a->components * (uint64_t)n; }

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
    riddle_io_print(
        file, "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n", type);
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
                                                   riddle_io_array position, int n_cells, const int *ends, const int *corners,
                                                   const riddle_io_array *arrays, int n_arrays) {
    bool vertices = strcmp(cell_kind, "Verts") == 0;
    if (!riddle_io__are_whole(arrays, n_arrays, n) || !riddle_io__are_whole(&position, 1, n) || position.components != 3)
        return riddle_io__fail(RIDDLE_IO_BAD_ARGUMENT, name, "an array is missing, or the number of points is negative");
    if (!vertices && !riddle_io__are_cells(n, n_cells, ends, corners))
        return riddle_io__fail(RIDDLE_IO_BAD_ARGUMENT, name, "the ends of the cells do not rise, or a corner is no point");
    int n_corners = vertices ? n : n_cells > 0 ? ends[n_cells - 1] : 0;
    riddle_io_file *file = riddle_io_open(folder, name);
    if (!file) return RIDDLE_IO_NOT_WRITTEN;
    uint64_t offset = 0;
    riddle_io__head(file, "PolyData");
    riddle_io_print(
        file,
        "<PolyData>\n<Piece NumberOfPoints=\"%d\" NumberOfVerts=\"%d\" NumberOfLines=\"%d\" NumberOfStrips=\"0\" NumberOfPolys=\"%d\">\n",
        n, vertices ? n : 0, strcmp(cell_kind, "Lines") == 0 ? n_cells : 0, strcmp(cell_kind, "Polys") == 0 ? n_cells : 0);
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

RIDDLE_IO_API riddle_io_status riddle_io_lines(const char *folder, const char *name, int n_points, riddle_io_array position, int n_cells,
                                               const int *ends, const int *corners, const riddle_io_array *arrays, int n_arrays) {
    return riddle_io__polydata(folder, name, "Lines", n_points, position, n_cells, ends, corners, arrays, n_arrays);
}

RIDDLE_IO_API riddle_io_status riddle_io_polygons(const char *folder, const char *name, int n_points, riddle_io_array position, int n_cells,
                                                  const int *ends, const int *corners, const riddle_io_array *arrays, int n_arrays) {
    return riddle_io__polydata(folder, name, "Polys", n_points, position, n_cells, ends, corners, arrays, n_arrays);
}

RIDDLE_IO_API riddle_io_status riddle_io_cells(const char *folder, const char *name, const int size[3], const double origin[3],
                                               const double spacing[3], const riddle_io_array *arrays, int n_arrays) {
    double cells = size ? (double)size[0] * size[1] * size[2] : 0.0;
    if (!(size && origin && spacing && size[0] > 0 && size[1] > 0 && size[2] > 0 && cells < 2147483647.0))
        return riddle_io__fail(RIDDLE_IO_BAD_ARGUMENT, name, "a grid of no cells, or of 2^31 or more");
    int n = size[0] * size[1] * size[2];
    if (!riddle_io__are_whole(arrays, n_arrays, n)) return riddle_io__fail(RIDDLE_IO_BAD_ARGUMENT, name, "an array is missing");
    riddle_io_file *file = riddle_io_open(folder, name);
    if (!file) return RIDDLE_IO_NOT_WRITTEN;
    uint64_t offset = 0;
    riddle_io__head(file, "ImageData");
    riddle_io_print(file, "<ImageData WholeExtent=\"0 %d 0 %d 0 %d\" Origin=\"%.9g %.9g %.9g\" Spacing=\"%.9g %.9g %.9g\">\n", size[0],
                    size[1], size[2], origin[0], origin[1], origin[2], spacing[0], spacing[1], spacing[2]);
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
    snprintf(text, size, "%s_%04d.%s", series->stem, i, series->frames[i].extension); /* it fits: the lengths were checked */
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
    const size_t folder = slash ? (size_t)(slash - series->stem) + 1 : 0; /* readers look for a frame beside the index */
    if (!riddle_io__look_for_frames(series)) return riddle_io__no_memory(series->stem);
    snprintf(name, sizeof name, "%s.pvd", series->stem);
    riddle_io_file *file = riddle_io_open(series->folder, name);
    if (!file) return RIDDLE_IO_NOT_WRITTEN;
    riddle_io_print(file,
                    "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n");
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
        riddle_io__frame *frames = (riddle_io__frame *)RIDDLE_IO_REALLOC(series->frames, (size_t)capacity * sizeof *frames);
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

/* ================================================== >>figures: bodies =================================================== */

/* ---- what a figure holds ---- */

typedef enum {
    RIDDLE_IO__LINE,
    RIDDLE_IO__POINTS,
    RIDDLE_IO__BAND,
    RIDDLE_IO__ERROR_BARS,
    RIDDLE_IO__DISCS,
    RIDDLE_IO__BARS,
    RIDDLE_IO__HEAT,
    RIDDLE_IO__HORIZONTAL,
    RIDDLE_IO__VERTICAL,
    RIDDLE_IO__TEXT,
    RIDDLE_IO__TEXT_SHARE
} riddle_io__series_kind;

typedef struct {
    riddle_io__series_kind kind;
    char *label;
    double *x, *y, *z; /* z: upper edge of a band, half-length of an error bar, the two ends of a heat map's colours */
    int n;
    char **names;      /* of the groups of bars */
    int columns, rows; /* of a heat map in y, its corners in x[4] */
    int colour, flags;
} riddle_io__series;

typedef struct {
    double low, high;
    bool log, fixed_range;
    char *label;
} riddle_io__axis;

typedef struct {
    double x, y, width, height;      /* the data area in the figure */
    double left, right, top, bottom; /* room for what stands around it */
    double legend_x, legend_y, legend_width, legend_height;
} riddle_io__layout;

typedef struct {
    bool used, equal, legend_outside, legend_above;
    char *title;
    riddle_io__axis x, y;
    riddle_io__series *all;
    int n, capacity, next_colour;
    riddle_io__layout at;
} riddle_io__panel;

struct riddle_io_plot {
    char *title;
    int rows, columns, chosen;
    double width, height;
    riddle_io__panel *panels;
    bool failed; /* out of memory */
};

/* Returns a colour of Okabe & Ito (2008), which the colour-blind can tell apart; brown replaces their yellow, which is too pale for a
   line. */
static inline const char *riddle_io__palette(int colour) {
    static const char *const colours[8] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7A5C2E", "#555555"};
    return colours[colour & 7];
}

#define RIDDLE_IO__TICK_SIZE 14.0 /* of letters; lengths in points */
#define RIDDLE_IO__LABEL_SIZE 15.0
#define RIDDLE_IO__TITLE_SIZE 16.0
#define RIDDLE_IO__LEGEND_ROW 21.0
#define RIDDLE_IO__SWATCH 30.0
#define RIDDLE_IO__PAD 8.0

/* ---- building ---- */

static inline char *riddle_io__copy_text(riddle_io_plot *p, const char *text) {
    if (!text) return NULL;
    size_t size = strlen(text) + 1;
    char *c = (char *)RIDDLE_IO_REALLOC(NULL, size);
    if (c) memcpy(c, text, size);
    else p->failed = true;
    return c;
}

static inline double *riddle_io__copy_numbers(riddle_io_plot *p, const double *values, int n) {
    if (!values || n <= 0) return NULL;
    double *c = (double *)RIDDLE_IO_REALLOC(NULL, (size_t)n * sizeof *c);
    if (c) memcpy(c, values, (size_t)n * sizeof *c);
    else p->failed = true;
    return c;
}

RIDDLE_IO_API riddle_io_plot *riddle_io_plot_new(const char *title, int rows, int columns) {
    riddle_io_plot *p = (riddle_io_plot *)riddle_io__zeroed(sizeof *p);
    if (!p) {
        riddle_io__no_memory("a figure");
        return NULL;
    }
    p->rows = rows < 1 ? 1 : rows > 6 ? 6 : rows;
    p->columns = columns < 1 ? 1 : columns > 6 ? 6 : columns;
    p->panels = (riddle_io__panel *)riddle_io__zeroed((size_t)(p->rows * p->columns) * sizeof *p->panels);
    if (!p->panels) {
        riddle_io__release(p);
        riddle_io__no_memory("a figure");
        return NULL;
    }
    p->title = riddle_io__copy_text(p, title);
    int most = p->rows > p->columns ? p->rows : p->columns;
    p->width = most == 1 ? 540.0 : most == 2 ? 430.0 : 340.0;
    p->height = most == 1 ? 360.0 : most == 2 ? 300.0 : 245.0;
    return p;
}

RIDDLE_IO_API void riddle_io_plot_panel_size(riddle_io_plot *p, double width, double height) {
    if (!p) return;
    if (width >= 80.0 && width <= 4000.0) p->width = width;
    if (height >= 60.0 && height <= 4000.0) p->height = height;
}

static inline void riddle_io__free_series(riddle_io__series *s) {
    riddle_io__release(s->label);
    riddle_io__release(s->x);
    riddle_io__release(s->y);
    riddle_io__release(s->z);
    for (int i = 0; s->names && i < s->n; i++) riddle_io__release(s->names[i]);
    riddle_io__release(s->names);
}

RIDDLE_IO_API void riddle_io_plot_free(riddle_io_plot *p) {
    if (!p) return;
    for (int i = 0; i < p->rows * p->columns; i++) {
        riddle_io__panel *a = &p->panels[i];
        for (int k = 0; k < a->n; k++) riddle_io__free_series(&a->all[k]);
        riddle_io__release(a->all);
        riddle_io__release(a->title);
        riddle_io__release(a->x.label);
        riddle_io__release(a->y.label);
    }
    riddle_io__release(p->panels);
    riddle_io__release(p->title);
    riddle_io__release(p);
}

static inline riddle_io__panel *riddle_io__current(riddle_io_plot *p) {
    if (!p) return NULL;
    p->panels[p->chosen].used = true;
    return &p->panels[p->chosen];
}

RIDDLE_IO_API void riddle_io_plot_panel(riddle_io_plot *p, int row, int column, const char *x_label, const char *y_label) {
    if (!p || row < 0 || row >= p->rows || column < 0 || column >= p->columns) return;
    p->chosen = row * p->columns + column;
    riddle_io__panel *a = riddle_io__current(p);
    riddle_io__release(a->x.label);
    riddle_io__release(a->y.label);
    a->x.label = riddle_io__copy_text(p, x_label);
    a->y.label = riddle_io__copy_text(p, y_label);
}

RIDDLE_IO_API void riddle_io_plot_title(riddle_io_plot *p, const char *title) {
    riddle_io__panel *a = riddle_io__current(p);
    if (!a) return;
    riddle_io__release(a->title);
    a->title = riddle_io__copy_text(p, title);
}

RIDDLE_IO_API void riddle_io_plot_log_x(riddle_io_plot *p) {
    riddle_io__panel *a = riddle_io__current(p);
    if (a) a->x.log = true;
}

RIDDLE_IO_API void riddle_io_plot_log_y(riddle_io_plot *p) {
    riddle_io__panel *a = riddle_io__current(p);
    if (a) a->y.log = true;
}

static inline void riddle_io__set_range(riddle_io__axis *a, double low, double high) {
    if (!(low < high) || !(high - low < HUGE_VAL)) return;
    a->low = low;
    a->high = high;
    a->fixed_range = true;
}

RIDDLE_IO_API void riddle_io_plot_range_x(riddle_io_plot *p, double low, double high) {
    riddle_io__panel *a = riddle_io__current(p);
    if (a) riddle_io__set_range(&a->x, low, high);
}

RIDDLE_IO_API void riddle_io_plot_range_y(riddle_io_plot *p, double low, double high) {
    riddle_io__panel *a = riddle_io__current(p);
    if (a) riddle_io__set_range(&a->y, low, high);
}

RIDDLE_IO_API void riddle_io_plot_equal(riddle_io_plot *p) {
    riddle_io__panel *a = riddle_io__current(p);
    if (a) a->equal = true;
}

RIDDLE_IO_API void riddle_io_plot_legend_outside(riddle_io_plot *p) {
    riddle_io__panel *a = riddle_io__current(p);
    if (a) a->legend_outside = true;
}

static inline riddle_io__series *riddle_io__add(riddle_io_plot *p, riddle_io__series_kind kind, const char *label, int n) {
    riddle_io__panel *a = riddle_io__current(p);
    if (!a) return NULL;
    if (a->n == a->capacity) {
        int capacity = 2 * a->capacity + 8;
        riddle_io__series *larger = (riddle_io__series *)RIDDLE_IO_REALLOC(a->all, (size_t)capacity * sizeof *larger);
        if (!larger) {
            p->failed = true;
            return NULL;
        }
        a->all = larger;
        a->capacity = capacity;
    }
    riddle_io__series *s = &a->all[a->n++];
    memset(s, 0, sizeof *s);
    s->kind = kind;
    s->label = riddle_io__copy_text(p, label);
    s->n = n > 0 ? n : 0;
    s->colour = RIDDLE_IO_GREY;
    return s;
}

static inline riddle_io__series *riddle_io__add_coloured(riddle_io_plot *p, riddle_io__series_kind kind, const char *label, const double *x,
                                                         const double *y, const double *z, int n) {
    riddle_io__series *s = riddle_io__add(p, kind, label, n);
    if (!s) return NULL;
    s->x = riddle_io__copy_numbers(p, x, n);
    s->y = riddle_io__copy_numbers(p, y, n);
    s->z = riddle_io__copy_numbers(p, z, n);
    if ((!s->x && kind != RIDDLE_IO__BARS) || !s->y) s->n = 0;
    if (!s->z && (z || kind == RIDDLE_IO__BAND || kind == RIDDLE_IO__ERROR_BARS || kind == RIDDLE_IO__DISCS)) s->n = 0;
    s->colour = riddle_io__current(p)->next_colour++ % 8;
    return s;
}

RIDDLE_IO_API void riddle_io_plot_line(riddle_io_plot *p, const char *label, const double *x, const double *y, int n) {
    riddle_io__add_coloured(p, RIDDLE_IO__LINE, label, x, y, NULL, n);
}

RIDDLE_IO_API void riddle_io_plot_points(riddle_io_plot *p, const char *label, const double *x, const double *y, int n) {
    riddle_io__add_coloured(p, RIDDLE_IO__POINTS, label, x, y, NULL, n);
}

RIDDLE_IO_API void riddle_io_plot_band(riddle_io_plot *p, const char *label, const double *x, const double *low, const double *high,
                                       int n) {
    riddle_io__add_coloured(p, RIDDLE_IO__BAND, label, x, low, high, n);
}

RIDDLE_IO_API void riddle_io_plot_error_bars(riddle_io_plot *p, const char *label, const double *x, const double *y,
                                             const double *plus_minus, int n) {
    riddle_io__add_coloured(p, RIDDLE_IO__ERROR_BARS, label, x, y, plus_minus, n);
}

RIDDLE_IO_API void riddle_io_plot_discs(riddle_io_plot *p, const char *label, const double *x, const double *y, const double *radius,
                                        int n) {
    riddle_io__add_coloured(p, RIDDLE_IO__DISCS, label, x, y, radius, n);
}

RIDDLE_IO_API void riddle_io_plot_bars(riddle_io_plot *p, const char *label, const char *const *names, const double *values, int n) {
    riddle_io__series *s = riddle_io__add_coloured(p, RIDDLE_IO__BARS, label, NULL, values, NULL, n);
    if (!s || !names) {
        if (s) s->n = 0;
        return;
    }
    if (s->n == 0) return;
    s->names = (char **)riddle_io__zeroed((size_t)s->n * sizeof *s->names);
    if (!s->names) p->failed = true;
    for (int i = 0; s->names && i < s->n; i++) s->names[i] = riddle_io__copy_text(p, names[i]);
}

RIDDLE_IO_API void riddle_io_plot_heat(riddle_io_plot *p, const char *label, const double *values, int columns, int rows, double x0,
                                       double x1, double y0, double y1) {
    double corners[4] = {x0, x1, y0, y1};
    if (columns < 1 || rows < 1 || columns > 100000000 / rows) return;
    riddle_io__series *s = riddle_io__add(p, RIDDLE_IO__HEAT, label, 4);
    if (!s) return;
    s->x = riddle_io__copy_numbers(p, corners, 4);
    s->y = riddle_io__copy_numbers(p, values, columns * rows);
    s->columns = columns;
    s->rows = rows;
    if (!s->x || !s->y) s->n = 0;
}

RIDDLE_IO_API void riddle_io_plot_heat_range(riddle_io_plot *p, double low, double high) {
    riddle_io__panel *a = riddle_io__current(p);
    const double ends[2] = {low, high};
    if (!a || a->n == 0 || a->all[a->n - 1].kind != RIDDLE_IO__HEAT || !(low < high) || !(high - low < HUGE_VAL)) return;
    riddle_io__release(a->all[a->n - 1].z);
    a->all[a->n - 1].z = riddle_io__copy_numbers(p, ends, 2);
}

RIDDLE_IO_API void riddle_io_plot_style(riddle_io_plot *p, int flags, int colour) {
    riddle_io__panel *a = riddle_io__current(p);
    if (!a || a->n == 0) return;
    riddle_io__series *s = &a->all[a->n - 1];
    s->flags = flags;
    if (colour == RIDDLE_IO_NEXT) return;
    if (s->kind <= RIDDLE_IO__BARS) a->next_colour--; /* releases the colour that it took */
    if (colour == RIDDLE_IO_SAME) s->colour = a->n > 1 ? a->all[a->n - 2].colour : 0;
    else s->colour = colour >= 0 ? colour % 8 : colour;
}

static inline void riddle_io__add_at(riddle_io_plot *p, riddle_io__series_kind kind, const char *label, double x, double y) {
    riddle_io__series *s = riddle_io__add(p, kind, label, 1);
    if (!s) return;
    s->x = riddle_io__copy_numbers(p, &x, 1);
    s->y = riddle_io__copy_numbers(p, &y, 1);
    if (!s->x || !s->y) s->n = 0;
}

RIDDLE_IO_API void riddle_io_plot_horizontal(riddle_io_plot *p, const char *label, double y) {
    riddle_io__add_at(p, RIDDLE_IO__HORIZONTAL, label, 0.0, y);
}

RIDDLE_IO_API void riddle_io_plot_vertical(riddle_io_plot *p, const char *label, double x) {
    riddle_io__add_at(p, RIDDLE_IO__VERTICAL, label, x, 0.0);
}

RIDDLE_IO_API void riddle_io_plot_text(riddle_io_plot *p, double x, double y, const char *text) {
    riddle_io__add_at(p, RIDDLE_IO__TEXT, text, x, y);
}

RIDDLE_IO_API void riddle_io_plot_text_share(riddle_io_plot *p, double x_share, double y_share, const char *text) {
    riddle_io__add_at(p, RIDDLE_IO__TEXT_SHARE, text, x_share, y_share);
}

/* ---- axes ---- */

static inline bool riddle_io__can_show(const riddle_io__axis *a, double v) { return v - v == 0.0 && (!a->log || v > 0.0); }

static inline void riddle_io__include(const riddle_io__axis *a, double v, double *low, double *high) {
    if (!riddle_io__can_show(a, v)) return;
    if (v < *low) *low = v;
    if (v > *high) *high = v;
}

/* Sets the range of an axis from the range of its data. */
static inline void riddle_io__settle(riddle_io__axis *a, double low, double high, bool tight) {
    if (a->fixed_range && riddle_io__can_show(a, a->low)) return;
    if (!(low <= high)) {
        low = a->log ? 0.1 : 0.0;
        high = 1.0;
    }
    low = fmin(fmax(low, a->log ? 1e-300 : -1e300), 1e300);
    high = fmin(fmax(high, a->log ? 1e-300 : -1e300), 1e300);
    if (a->log) {
        double margin = tight ? 0.0 : 0.04 * (log10(high) - log10(low));
        if (!(high > low * 1.0000001)) margin = 0.5;
        a->low = fmax(low * pow(10.0, -margin), 1e-300);
        a->high = fmin(high * pow(10.0, margin), 1e300);
        return;
    }
    double span = high - low, size = fmax(fabs(low), fabs(high));
    if (!(span > 1e-12 * size && span > 1e-280)) span = size > 1e-280 ? 0.2 * size : 1.0;
    a->low = tight || low == 0.0 || (low > 0.0 && low < 0.2 * high) ? (tight ? low : 0.0) : low - 0.05 * span;
    a->high = tight || high == 0.0 ? high : high + 0.05 * span;
    if (!(a->high - a->low > 0.5 * span)) a->high = a->low + span;
}

/* Returns the place of v along an axis, 0 .. 1. */
static inline double riddle_io__share(const riddle_io__axis *a, double v) {
    if (a->log) return (log(v) - log(a->low)) / (log(a->high) - log(a->low)); /* a quotient could overflow */
    return (v - a->low) / (a->high - a->low);
}

typedef struct {
    double at;
    bool major;
    char text[80]; /* SVG, with a raised exponent where needed */
    int letters;
} riddle_io__tick;

enum { RIDDLE_IO__MOST_TICKS = 120 };

static inline void riddle_io__replace_minus(char *text, size_t size) {
    size_t length = strlen(text);
    if (text[0] != '-' || length + 3 > size) return;
    memmove(text + 3, text + 1, length);
    memcpy(text, "\xE2\x88\x92", 3);
}

static inline int riddle_io__letters_of(const char *text) {
    int n = 0;
    for (; *text; text++) n += ((unsigned char)*text & 0xC0) != 0x80;
    return n;
}

/* Returns a step of 1, 2, 5 x 10^k that gives about `wanted` intervals; *minor: intervals between two. */
static inline double riddle_io__nice_step(double span, int wanted, int *minor) {
    double raw = span / wanted, power = pow(10.0, floor(log10(raw))), m = raw / power;
    *minor = m > 1.41 && m <= 3.16 ? 4 : 5;
    return power * (m <= 1.41 ? 1.0 : m <= 3.16 ? 2.0 : m <= 7.07 ? 5.0 : 10.0);
}

/* Makes the ticks of a linear axis. Returns their number. *exponent: 10^exponent is divided out of the labels and is written at the end of
   the axis. */
static inline int riddle_io__linear_ticks(const riddle_io__axis *a, int wanted, riddle_io__tick *ticks, int *exponent) {
    int minor, n = 0;
    double step = riddle_io__nice_step(a->high - a->low, wanted, &minor), fine = step / minor, largest = fmax(fabs(a->low), fabs(a->high));
    int size = largest > 0.0 ? (int)floor(log10(largest) + 1e-9) : 0, digits = (int)floor(log10(step) + 1e-9);
    *exponent = size >= 6 || size <= -3 ? 3 * (int)floor(size / 3.0) : 0;
    int decimals = *exponent - digits;
    if (decimals < 0) decimals = 0;
    if (decimals > 12) decimals = 12;
    for (double k = ceil(a->low / fine - 1e-9); k * fine <= a->high + 1e-9 * step && n < RIDDLE_IO__MOST_TICKS; k += 1.0) {
        riddle_io__tick *t = &ticks[n++];
        t->at = k * fine;
        t->major = fabs(k / minor - floor(k / minor + 0.5)) < 1e-6;
        double shown = t->at / pow(10.0, *exponent);
        if (fabs(t->at) < 1e-9 * step) shown = 0.0;
        snprintf(t->text, sizeof t->text, "%.*f", decimals, shown);
        riddle_io__use_point(t->text);
        riddle_io__replace_minus(t->text, sizeof t->text);
        t->letters = riddle_io__letters_of(t->text);
        if (t->at < a->low) t->at = a->low;
        if (t->at > a->high) t->at = a->high;
    }
    return n;
}

/* Writes m x 10^exponent as the text of a tick. */
static inline void riddle_io__power_text(riddle_io__tick *t, int m, int exponent, bool plain) {
    char raised[20], front[10] = "";
    if (plain) {
        snprintf(t->text, sizeof t->text, "%.*f", exponent < 0 ? -exponent : 0, m * pow(10.0, exponent));
        riddle_io__use_point(t->text);
        t->letters = (int)strlen(t->text);
        return;
    }
    snprintf(raised, sizeof raised, "%d", exponent);
    riddle_io__replace_minus(raised, sizeof raised);
    if (m != 1) snprintf(front, sizeof front, "%d\xC3\x97", m % 10);
    snprintf(t->text, sizeof t->text, "%s10<tspan class=\"up\" dy=\"-6\">%s</tspan>", front, raised);
    t->letters = riddle_io__letters_of(front) + 2 + riddle_io__letters_of(raised);
}

static inline int riddle_io__log_ticks(const riddle_io__axis *a, int wanted, riddle_io__tick *ticks) {
    double low = log10(a->low), high = log10(a->high);
    int first = (int)floor(low), last = (int)floor(high), n = 0, decades = 0;
    for (int e = first; e <= last + 1; e++) decades += e >= low - 1e-9 && e <= high + 1e-9;
    int every = 1 + (decades - 1) / (wanted + 2);
    bool plain = first >= -3 && last <= 3, few = decades < 2;
    int steps_shown = 0;
    for (int e = first; e <= last; e++)
        for (int m = 2; m <= 9; m++) {
            double v = m * pow(10.0, e);
            steps_shown += v >= a->low && v <= a->high;
        }
    for (int e = first; e <= last; e++) {
        for (int m = 1; m <= 9 && n < RIDDLE_IO__MOST_TICKS; m++) {
            if (every > 1 && m > 1) continue;
            double v = m * pow(10.0, e);
            if (v < a->low * (1.0 - 1e-9) || v > a->high * (1.0 + 1e-9)) continue;
            riddle_io__tick *t = &ticks[n++];
            t->at = v;
            t->major = m == 1 && e % every == 0;
            t->letters = 0;
            t->text[0] = '\0';
            if (few && (m == 2 || m == 5 || steps_shown <= 6)) t->major = true; /* too few powers of ten to read it by */
            if (t->major) riddle_io__power_text(t, m, e, plain);
        }
    }
    return n;
}

/* Makes the ticks of an axis. A logarithmic axis within a factor of two gets linear ones: it has no useful powers of ten. */
static inline int riddle_io__make_ticks(const riddle_io__axis *a, int wanted, riddle_io__tick *ticks, int *exponent) {
    *exponent = 0;
    if (a->log && a->high / a->low > 2.0) return riddle_io__log_ticks(a, wanted, ticks);
    return riddle_io__linear_ticks(a, wanted, ticks, exponent);
}

/* ---- text widths, by the average letters of the widest of the faces that the figures name, DejaVu Sans ---- */

static inline double riddle_io__text_width(const char *text, double size) {
    double w = 0.0;
    for (; *text; text++) {
        if (((unsigned char)*text & 0xC0) == 0x80) continue;
        w += strchr("iljtfr.,:;'|()[] ", *text) ? 0.35 : strchr("mwMW", *text) ? 0.92 : *text >= 'A' && *text <= 'Z' ? 0.70 : 0.62;
    }
    return w * size;
}

/* ---- SVG ---- */

static inline void riddle_io__escaped(riddle_io_file *f, const char *text) {
    for (; text && *text; text++) {
        if (*text == '&') riddle_io_print(f, "&amp;");
        else if (*text == '<') riddle_io_print(f, "&lt;");
        else if (*text == '>') riddle_io_print(f, "&gt;");
        else if ((unsigned char)*text >= 32) riddle_io_write(f, text, 1);
    }
}

static inline void riddle_io__text_at(riddle_io_file *f, double x, double y, const char *anchor, const char *style, const char *text) {
    if (!text || !*text) return;
    riddle_io_print(f, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" class=\"%s\">", x, y, anchor, style);
    riddle_io__escaped(f, text);
    riddle_io_print(f, "</text>\n");
}

/* Draws the factor that was divided out of the numbers of an axis. */
static inline void riddle_io__power_of_ten(riddle_io_file *f, double x, double y, const char *anchor, int exponent) {
    if (!exponent) return;
    riddle_io_print(f,
                    "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" class=\"tick\">\xC3\x97"
                    "10<tspan class=\"up\" dy=\"-6\">%s%d</tspan></text>\n",
                    x, y, anchor, exponent < 0 ? "\xE2\x88\x92" : "", abs(exponent));
}

/* Returns a font size at which a text fits into its room; at least half the usual one. */
static inline double riddle_io__fitting(const char *text, double size, double room) {
    double width = riddle_io__text_width(text, size);
    return width > room ? fmax(0.5 * size, size * room / width) : size;
}

static inline void riddle_io__upright_label(riddle_io_file *f, double x, double y, double room, const char *text) {
    riddle_io_print(
        f, "<text transform=\"translate(%.1f %.1f) rotate(-90)\" text-anchor=\"middle\" class=\"label\" style=\"font-size:%.1fpx\">", x, y,
        riddle_io__fitting(text, RIDDLE_IO__LABEL_SIZE, room));
    riddle_io__escaped(f, text);
    riddle_io_print(f, "</text>\n");
}

static inline const char *riddle_io__colour_of(const riddle_io__series *s) {
    if (s->colour == RIDDLE_IO_GREY) return "#888888";
    if (s->colour == RIDDLE_IO_BLACK) return "#222222";
    return riddle_io__palette(s->colour);
}

/* Computes the colour of a share 0..1 in the map viridis (van der Walt & Smith 2015), given at nine places. */
static inline void riddle_io__heat_colour(double share01, int rgb[3]) {
    static const int map[9][3] = {{68, 1, 84},    {71, 44, 122}, {59, 81, 139},  {44, 113, 142}, {33, 144, 141},
                                  {39, 173, 129}, {92, 200, 99}, {170, 220, 50}, {253, 231, 37}};
    double s = share01 < 0.0 ? 0.0 : share01 > 1.0 ? 8.0 : 8.0 * share01;
    int k = s >= 8.0 ? 7 : (int)s;
    for (int i = 0; i < 3; i++) rgb[i] = (int)(map[k][i] + (s - k) * (map[k + 1][i] - map[k][i]) + 0.5);
}

static inline double riddle_io__px(const riddle_io__panel *a, double x) { return a->at.x + a->at.width * riddle_io__share(&a->x, x); }

static inline double riddle_io__py(const riddle_io__panel *a, double y) {
    return a->at.y + a->at.height * (1.0 - riddle_io__share(&a->y, y));
}

static inline bool riddle_io__visible(const riddle_io__panel *a, double x, double y) {
    return riddle_io__can_show(&a->x, x) && riddle_io__can_show(&a->y, y);
}

/* Limits a coordinate to what a renderer can take. */
static inline double riddle_io__limited(double v) { return v < -1e5 ? -1e5 : v > 1e5 ? 1e5 : v; }

static inline void riddle_io__draw_path(riddle_io_file *f, const riddle_io__panel *a, const riddle_io__series *s) {
    const char *dash = s->flags & RIDDLE_IO_DASHED   ? " stroke-dasharray=\"8 5\""
                       : s->flags & RIDDLE_IO_DOTTED ? " stroke-dasharray=\"2 4\""
                                                     : "";
    double width = s->flags & RIDDLE_IO_THIN ? 1.1 : 2.4;
    riddle_io_print(f,
                    "<path fill=\"none\" stroke=\"%s\" stroke-width=\"%.1f\" stroke-linejoin=\"round\" stroke-linecap=\"round\"%s%s d=\"",
                    riddle_io__colour_of(s), width, dash, s->flags & RIDDLE_IO_FAINT ? " stroke-opacity=\"0.35\"" : "");
    bool pen_down = false;
    double last_x = 0.0, last_y = 0.0;
    for (int i = 0; i < s->n; i++) {
        if (!riddle_io__visible(a, s->x[i], s->y[i])) {
            pen_down = false;
            continue;
        }
        double x = riddle_io__limited(riddle_io__px(a, s->x[i])), y = riddle_io__limited(riddle_io__py(a, s->y[i]));
        bool last = i + 1 == s->n || !riddle_io__visible(a, s->x[i + 1], s->y[i + 1]);
        if (pen_down && !last && fabs(x - last_x) < 0.3 && fabs(y - last_y) < 0.3) continue;
        if (pen_down && s->flags & RIDDLE_IO_STEPS) riddle_io_print(f, "H%.2f", x);
        riddle_io_print(f, "%s%.2f %.2f", pen_down ? "L" : "M", x, y);
        pen_down = true;
        last_x = x;
        last_y = y;
    }
    riddle_io_print(f, "\"/>\n");
}

/* Draws a marker; each colour has its own shape, for readers who cannot tell the colours apart. */
static inline void riddle_io__draw_marker(riddle_io_file *f, const riddle_io__series *s, double x, double y, double r) {
    switch (s->colour < 0 ? 0 : s->colour % 4) {
    case 1:
        riddle_io_print(f, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\"/>\n", x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r);
        break;
    case 2: riddle_io_print(f, "<path d=\"M%.2f %.2fl%.2f %.2fh%.2fz\"/>\n", x, y - 1.2 * r, 1.15 * r, 2.0 * r, -2.3 * r); break;
    case 3:
        riddle_io_print(f, "<path d=\"M%.2f %.2fl%.2f %.2fl%.2f %.2fl%.2f %.2fz\"/>\n", x, y - 1.3 * r, 1.3 * r, 1.3 * r, -1.3 * r, 1.3 * r,
                        -1.3 * r, -1.3 * r);
        break;
    default: riddle_io_print(f, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\"/>\n", x, y, r);
    }
}

static inline void riddle_io__draw_points(riddle_io_file *f, const riddle_io__panel *a, const riddle_io__series *s) {
    double r = s->n > 1500 ? 1.4 : s->n > 200 || s->flags & RIDDLE_IO_THIN ? 2.4 : 4.0;
    riddle_io_print(f, "<g fill=\"%s\" stroke=\"white\" stroke-width=\"%s\"%s>\n", riddle_io__colour_of(s), r > 3.0 ? "0.8" : "0",
                    s->n > 200 || s->flags & RIDDLE_IO_FAINT ? " fill-opacity=\"0.55\"" : "");
    for (int i = 0; i < s->n; i++) {
        if (!riddle_io__visible(a, s->x[i], s->y[i])) continue;
        double u = riddle_io__share(&a->x, s->x[i]), v = riddle_io__share(&a->y, s->y[i]);
        if (u < -1e-6 || u > 1.0 + 1e-6 || v < -1e-6 || v > 1.0 + 1e-6) continue;
        riddle_io__draw_marker(f, s, riddle_io__px(a, s->x[i]), riddle_io__py(a, s->y[i]), r);
    }
    riddle_io_print(f, "</g>\n");
}

static inline double riddle_io__floor_of(const riddle_io__axis *a, double v) { return a->log && !(v > 0.0) ? a->low : v; }

static inline void riddle_io__draw_band(riddle_io_file *f, const riddle_io__panel *a, const riddle_io__series *s) {
    for (int i = 0; i < s->n;) {
        int end = i;
        while (end < s->n && riddle_io__visible(a, s->x[end], s->z[end]) && s->y[end] - s->y[end] == 0.0) end++;
        if (end - i > 1) {
            riddle_io_print(f, "<path fill=\"%s\" fill-opacity=\"0.22\" d=\"", riddle_io__colour_of(s));
            for (int k = i; k < end; k++)
                riddle_io_print(f, "%s%.2f %.2f", k == i ? "M" : "L", riddle_io__limited(riddle_io__px(a, s->x[k])),
                                riddle_io__limited(riddle_io__py(a, s->z[k])));
            for (int k = end - 1; k >= i; k--)
                riddle_io_print(f, "L%.2f %.2f", riddle_io__limited(riddle_io__px(a, s->x[k])),
                                riddle_io__limited(riddle_io__py(a, riddle_io__floor_of(&a->y, s->y[k]))));
            riddle_io_print(f, "Z\"/>\n");
        }
        i = end > i ? end : i + 1;
    }
}

static inline bool riddle_io__has_length(const riddle_io__series *s, int i) { return s->z[i] >= 0.0 && s->z[i] < HUGE_VAL; }

static inline void riddle_io__draw_error_bars(riddle_io_file *f, const riddle_io__panel *a, const riddle_io__series *s) {
    riddle_io_print(f, "<g stroke=\"%s\" stroke-width=\"1.6\">\n", riddle_io__colour_of(s));
    for (int i = 0; i < s->n; i++) {
        if (!riddle_io__visible(a, s->x[i], s->y[i]) || !riddle_io__has_length(s, i)) continue;
        double x = riddle_io__limited(riddle_io__px(a, s->x[i])), top = riddle_io__limited(riddle_io__py(a, s->y[i] + s->z[i])),
               base = riddle_io__limited(riddle_io__py(a, riddle_io__floor_of(&a->y, s->y[i] - s->z[i])));
        riddle_io_print(f, "<path d=\"M%.2f %.2fh8m-4 0V%.2fm-4 0h8\"/>\n", x - 4.0, top, base);
    }
    riddle_io_print(f, "</g>\n");
    riddle_io__draw_points(f, a, s);
}

static inline double riddle_io__disc_radius(const riddle_io__panel *a, const riddle_io__series *s, int i) {
    double r = riddle_io__px(a, s->x[i] + s->z[i]) - riddle_io__px(a, s->x[i]);
    return r > 0.0 && r < 1e5 ? r : 0.0;
}

/* Draws discs lit from the upper left: a light spot over the colour, and a dark rim. */
static inline void riddle_io__draw_discs(riddle_io_file *f, const riddle_io__panel *a, const riddle_io__series *s) {
    const char *colour = riddle_io__colour_of(s);
    riddle_io_print(f,
                    "<radialGradient id=\"ball%s\" cx=\"0.36\" cy=\"0.32\" r=\"0.75\"><stop offset=\"0\" stop-color=\"white\"/>"
                    "<stop offset=\"0.35\" stop-color=\"%s\"/><stop offset=\"1\" stop-color=\"#222\"/></radialGradient>\n",
                    colour + 1, colour);
    riddle_io_print(f, "<g fill=\"url(#ball%s)\">\n", colour + 1);
    for (int i = 0; i < s->n; i++) {
        if (!riddle_io__visible(a, s->x[i], s->y[i])) continue;
        double r = riddle_io__disc_radius(a, s, i);
        if (r > 0.0)
            riddle_io_print(f, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\"/>\n", riddle_io__limited(riddle_io__px(a, s->x[i])),
                            riddle_io__limited(riddle_io__py(a, s->y[i])), r);
    }
    riddle_io_print(f, "</g>\n");
}

/* Finds the place of a bar series among these, and their number. */
static inline void riddle_io__bar_place(const riddle_io__panel *a, const riddle_io__series *s, int *index, int *count) {
    *index = *count = 0;
    for (int i = 0; i < a->n; i++) {
        if (a->all[i].kind != RIDDLE_IO__BARS) continue;
        if (&a->all[i] == s) *index = *count;
        ++*count;
    }
}

static inline void riddle_io__bar_edges(const riddle_io__panel *a, const riddle_io__series *s, int i, double *left, double *right) {
    int index, count;
    riddle_io__bar_place(a, s, &index, &count);
    double width = 0.78 / count;
    *left = i - 0.39 + width * index;
    *right = *left + width * (count > 1 ? 0.94 : 1.0);
}

static inline void riddle_io__draw_bars(riddle_io_file *f, const riddle_io__panel *a, const riddle_io__series *s) {
    for (int i = 0; i < s->n; i++) {
        double left, right, base = a->y.log ? a->y.low : fmax(0.0, a->y.low);
        if (!riddle_io__can_show(&a->y, s->y[i])) continue;
        riddle_io__bar_edges(a, s, i, &left, &right);
        double y0 = riddle_io__limited(riddle_io__py(a, base)), y1 = riddle_io__limited(riddle_io__py(a, s->y[i])), top = fmin(y0, y1);
        riddle_io_print(f, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"%s\"/>\n", riddle_io__px(a, left), top,
                        riddle_io__px(a, right) - riddle_io__px(a, left), fabs(y1 - y0), riddle_io__colour_of(s));
    }
}

static inline void riddle_io__heat_range(const riddle_io__series *s, double *low, double *high) {
    if (s->z) {
        *low = s->z[0];
        *high = s->z[1];
        return;
    }
    static const riddle_io__axis plain = {0.0, 1.0, false, false, NULL};
    *low = HUGE_VAL;
    *high = -HUGE_VAL;
    for (int i = 0; i < s->columns * s->rows; i++) riddle_io__include(&plain, s->y[i], low, high);
    if (!(*low <= *high)) {
        *low = 0.0;
        *high = 1.0;
    }
    *low = fmin(fmax(*low, -1e300), 1e300); /* so that their difference is finite */
    *high = fmin(fmax(*high, -1e300), 1e300);
    if (!(*high > *low)) *high = *low + (*low != 0.0 ? fabs(*low) : 1.0);
}

static inline double riddle_io__between(double from, double to, int i, int n) {
    return from * (1.0 - (double)i / n) + to * ((double)i / n);
}

/* Returns the level of a value in a heat map, 0 .. 160, or -1 where there is no number. */
static inline int riddle_io__heat_level(double v, double low, double high) {
    return v - v == 0.0 ? (int)(160.0 * fmin(fmax((v - low) / (high - low), 0.0), 1.0)) : -1;
}

/* Neighbours of one colour in a row are one rectangle. */
static inline void riddle_io__draw_heat(riddle_io_file *f, const riddle_io__panel *a, const riddle_io__series *s) {
    double low, high;
    if (s->n == 0 || !riddle_io__visible(a, s->x[0], s->x[2]) || !riddle_io__visible(a, s->x[1], s->x[3])) return;
    riddle_io__heat_range(s, &low, &high);
    riddle_io_print(f, "<g shape-rendering=\"crispEdges\">\n");
    for (int row = 0; row < s->rows; row++) {
        double y0 = riddle_io__between(s->x[2], s->x[3], row, s->rows), y1 = riddle_io__between(s->x[2], s->x[3], row + 1, s->rows);
        double top = fmin(riddle_io__py(a, y0), riddle_io__py(a, y1)), height = fabs(riddle_io__py(a, y1) - riddle_io__py(a, y0));
        for (int i = 0, end; i < s->columns; i = end) {
            const double *values = s->y + (size_t)row * (size_t)s->columns;
            int level = riddle_io__heat_level(values[i], low, high), rgb[3];
            for (end = i + 1; end < s->columns && riddle_io__heat_level(values[end], low, high) == level;) end++;
            if (level < 0) continue;
            riddle_io__heat_colour((level + 0.5) / 161.0, rgb);
            double x0 = riddle_io__px(a, riddle_io__between(s->x[0], s->x[1], i, s->columns)),
                   x1 = riddle_io__px(a, riddle_io__between(s->x[0], s->x[1], end, s->columns));
            riddle_io_print(f, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"#%02x%02x%02x\"/>\n", fmin(x0, x1), top,
                            fabs(x1 - x0) + 0.3, height + 0.3, (unsigned)rgb[0], (unsigned)rgb[1], (unsigned)rgb[2]);
        }
    }
    riddle_io_print(f, "</g>\n");
}

static inline void riddle_io__draw_colour_bar(riddle_io_file *f, const riddle_io__panel *a, const riddle_io__series *s) {
    double low, high;
    riddle_io__heat_range(s, &low, &high);
    riddle_io__axis scale = {low, high, false, false, NULL};
    riddle_io__tick ticks[RIDDLE_IO__MOST_TICKS];
    int exponent, n = riddle_io__make_ticks(&scale, 5, ticks, &exponent);
    double x = a->at.x + a->at.width + 16.0, y = a->at.y, height = a->at.height, widest = 0.0;
    riddle_io_print(f, "<g shape-rendering=\"crispEdges\">\n");
    for (int i = 0; i < 64; i++) {
        int rgb[3];
        riddle_io__heat_colour((i + 0.5) / 64.0, rgb);
        riddle_io_print(f, "<rect x=\"%.1f\" y=\"%.2f\" width=\"14\" height=\"%.2f\" fill=\"#%02x%02x%02x\"/>\n", x,
                        y + height * (63 - i) / 64.0, height / 64.0 + 0.4, (unsigned)rgb[0], (unsigned)rgb[1], (unsigned)rgb[2]);
    }
    riddle_io_print(f, "</g>\n");
    for (int i = 0; i < n; i++) {
        if (!ticks[i].major) continue;
        double at = y + height * (1.0 - riddle_io__share(&scale, ticks[i].at));
        riddle_io_print(f, "<path d=\"M%.1f %.1fh5\" stroke=\"#333\"/><text x=\"%.1f\" y=\"%.1f\" class=\"tick\">%s</text>\n", x + 14.0, at,
                        x + 23.0, at + 5.0, ticks[i].text);
        widest = fmax(widest, 0.58 * RIDDLE_IO__TICK_SIZE * ticks[i].letters);
    }
    riddle_io__power_of_ten(f, x, y - 7.0, "start", exponent);
    if (s->label && *s->label) {
        double lx = x + 23.0 + widest + 16.0, ly = y + 0.5 * height;
        riddle_io__upright_label(f, lx, ly, height + 24.0, s->label);
    }
}

static inline void riddle_io__draw_reference(riddle_io_file *f, const riddle_io__panel *a, const riddle_io__series *s) {
    bool horizontal = s->kind == RIDDLE_IO__HORIZONTAL;
    double v = horizontal ? s->y[0] : s->x[0];
    const riddle_io__axis *along = horizontal ? &a->y : &a->x;
    if (!riddle_io__can_show(along, v) || riddle_io__share(along, v) < 0.0 || riddle_io__share(along, v) > 1.0) return;
    const char *dash = s->flags & RIDDLE_IO_DOTTED ? "2 4" : "6 4";
    if (horizontal) {
        double y = riddle_io__py(a, v);
        riddle_io_print(f, "<path d=\"M%.1f %.2fh%.1f\" stroke=\"%s\" stroke-width=\"1.5\" stroke-dasharray=\"%s\"/>\n", a->at.x, y,
                        a->at.width, riddle_io__colour_of(s), dash);
        riddle_io__text_at(f, a->at.x + a->at.width - 6.0, y - 5.0, "end", "note", s->label);
    } else {
        double x = riddle_io__px(a, v), width = s->label ? riddle_io__text_width(s->label, RIDDLE_IO__TICK_SIZE) : 0.0;
        bool right = x + width + 8.0 < a->at.x + a->at.width;
        riddle_io_print(f, "<path d=\"M%.2f %.1fv%.1f\" stroke=\"%s\" stroke-width=\"1.5\" stroke-dasharray=\"%s\"/>\n", x, a->at.y,
                        a->at.height, riddle_io__colour_of(s), dash);
        riddle_io__text_at(f, right ? x + 5.0 : x - 5.0, a->at.y + 16.0, right ? "start" : "end", "note", s->label);
    }
}

/* Finds where a text in a panel begins. One that would leave the panel at the right is moved to the left. Returns 0 if its place is not
   visible. */
static inline int riddle_io__text_place(const riddle_io__panel *a, const riddle_io__series *s, double *x, double *y) {
    if (s->kind == RIDDLE_IO__TEXT_SHARE) {
        *x = a->at.x + a->at.width * s->x[0];
        *y = a->at.y + a->at.height * (1.0 - s->y[0]);
    } else {
        if (!riddle_io__visible(a, s->x[0], s->y[0])) return 0;
        *x = riddle_io__limited(riddle_io__px(a, s->x[0]));
        *y = riddle_io__limited(riddle_io__py(a, s->y[0]));
    }
    const double last = s->label ? a->at.x + a->at.width - RIDDLE_IO__PAD - riddle_io__text_width(s->label, RIDDLE_IO__TICK_SIZE) : *x;
    if (*x > last) *x = last > a->at.x + RIDDLE_IO__PAD ? last : a->at.x + RIDDLE_IO__PAD;
    return 1;
}

static inline void riddle_io__draw_text(riddle_io_file *f, const riddle_io__panel *a, const riddle_io__series *s) {
    double x, y;
    if (riddle_io__text_place(a, s, &x, &y)) riddle_io__text_at(f, x, y, "start", "note", s->label);
}

static inline void riddle_io__draw_series(riddle_io_file *f, const riddle_io__panel *a, const riddle_io__series *s) {
    if (s->n == 0 && s->kind != RIDDLE_IO__DISCS) return; /* the legend uses the gradient that discs define */
    switch (s->kind) {
    case RIDDLE_IO__LINE:
        if (!(s->flags & RIDDLE_IO_NO_LINE)) riddle_io__draw_path(f, a, s);
        if (s->flags & RIDDLE_IO_MARKED) riddle_io__draw_points(f, a, s);
        break;
    case RIDDLE_IO__POINTS: riddle_io__draw_points(f, a, s); break;
    case RIDDLE_IO__BAND: riddle_io__draw_band(f, a, s); break;
    case RIDDLE_IO__ERROR_BARS: riddle_io__draw_error_bars(f, a, s); break;
    case RIDDLE_IO__DISCS: riddle_io__draw_discs(f, a, s); break;
    case RIDDLE_IO__BARS: riddle_io__draw_bars(f, a, s); break;
    case RIDDLE_IO__HEAT: riddle_io__draw_heat(f, a, s); break;
    case RIDDLE_IO__HORIZONTAL:
    case RIDDLE_IO__VERTICAL: riddle_io__draw_reference(f, a, s); break;
    case RIDDLE_IO__TEXT:
    case RIDDLE_IO__TEXT_SHARE: riddle_io__draw_text(f, a, s); break;
    }
}

/* ---- layout ---- */

static inline double riddle_io__entry_width(const riddle_io__series *s) {
    return RIDDLE_IO__SWATCH + 3 * RIDDLE_IO__PAD + riddle_io__text_width(s->label, RIDDLE_IO__TICK_SIZE);
}
static inline bool riddle_io__in_legend(const riddle_io__series *s) { return s->label && *s->label && (s->kind <= RIDDLE_IO__BARS); }

static inline const riddle_io__series *riddle_io__first_of(const riddle_io__panel *a, riddle_io__series_kind kind) {
    for (int i = 0; i < a->n; i++)
        if (a->all[i].kind == kind && a->all[i].n > 0) return &a->all[i];
    return NULL;
}

static inline void riddle_io__find_ranges(riddle_io__panel *a) {
    double x0 = HUGE_VAL, x1 = -HUGE_VAL, y0 = HUGE_VAL, y1 = -HUGE_VAL;
    bool tight = false;
    const riddle_io__series *bars = riddle_io__first_of(a, RIDDLE_IO__BARS);
    for (int k = 0; k < a->n; k++) {
        const riddle_io__series *s = &a->all[k];
        if (s->n == 0 || s->kind == RIDDLE_IO__TEXT || s->kind == RIDDLE_IO__TEXT_SHARE) continue;
        if (s->kind == RIDDLE_IO__HEAT) {
            tight = true;
            for (int i = 0; i < 2; i++) {
                riddle_io__include(&a->x, s->x[i], &x0, &x1);
                riddle_io__include(&a->y, s->x[2 + i], &y0, &y1);
            }
            continue;
        }
        for (int i = 0; i < s->n; i++) {
            if (s->x && s->kind != RIDDLE_IO__HORIZONTAL &&
                (!s->y || s->kind == RIDDLE_IO__VERTICAL || riddle_io__can_show(&a->y, s->y[i])))
                riddle_io__include(&a->x, s->x[i], &x0, &x1);
            if (s->kind == RIDDLE_IO__VERTICAL || (s->x && s->kind != RIDDLE_IO__HORIZONTAL && !riddle_io__can_show(&a->x, s->x[i])))
                continue;
            if (a->x.fixed_range && s->x && s->kind != RIDDLE_IO__HORIZONTAL && (s->x[i] < a->x.low || s->x[i] > a->x.high)) continue;
            riddle_io__include(&a->y, s->y[i], &y0, &y1);
            if (s->kind == RIDDLE_IO__BAND) riddle_io__include(&a->y, s->z[i], &y0, &y1);
            for (int side = -1; side <= 1 && s->kind == RIDDLE_IO__DISCS && riddle_io__has_length(s, i); side += 2) {
                riddle_io__include(&a->x, s->x[i] + side * s->z[i], &x0, &x1);
                riddle_io__include(&a->y, s->y[i] + side * s->z[i], &y0, &y1);
            }
            if (s->kind == RIDDLE_IO__ERROR_BARS && riddle_io__has_length(s, i)) {
                riddle_io__include(&a->y, s->y[i] - s->z[i], &y0, &y1);
                riddle_io__include(&a->y, s->y[i] + s->z[i], &y0, &y1);
            }
        }
    }
    if (bars) {
        a->x.log = false;
        if (!a->y.log) riddle_io__include(&a->y, 0.0, &y0, &y1);
        riddle_io__set_range(&a->x, -0.6, bars->n - 0.4);
    }
    riddle_io__settle(&a->x, x0, x1, tight);
    riddle_io__settle(&a->y, y0, y1, tight);
}

static inline void riddle_io__keep_equal(riddle_io__panel *a) {
    if (!a->equal || a->x.log || a->y.log) return;
    double x_unit = a->at.width / (a->x.high - a->x.low), y_unit = a->at.height / (a->y.high - a->y.low);
    riddle_io__axis *wider = x_unit > y_unit ? &a->x : &a->y;
    double factor = x_unit > y_unit ? x_unit / y_unit : y_unit / x_unit, middle = 0.5 * (wider->low + wider->high);
    double half = 0.5 * factor * (wider->high - wider->low);
    if (!(half < 1e300)) return;
    wider->low = middle - half;
    wider->high = middle + half;
}

static inline int riddle_io__ticks_along(double length, double spacing) {
    int n = (int)(length / spacing);
    return n < 2 ? 2 : n > 9 ? 9 : n;
}

static inline bool riddle_io__slanted_names(const riddle_io__panel *a, const riddle_io__series *bars) {
    for (int i = 0; i < bars->n; i++)
        if (bars->names && bars->names[i] && riddle_io__text_width(bars->names[i], RIDDLE_IO__TICK_SIZE) > 0.95 * a->at.width / bars->n)
            return true;
    return false;
}

/* Where the data are, on a coarse raster of the panel, so that the legend can stand where they are not. */
#define RIDDLE_IO__RASTER_X 72
#define RIDDLE_IO__RASTER_Y 48
typedef bool riddle_io__raster[RIDDLE_IO__RASTER_Y][RIDDLE_IO__RASTER_X];

static inline void riddle_io__stain(riddle_io__raster r, const riddle_io__panel *a, double x, double y, double reach) {
    double u = (x - a->at.x) / a->at.width, v = (y - a->at.y) / a->at.height;
    int i0 = (int)floor((u - reach / a->at.width) * RIDDLE_IO__RASTER_X), i1 = (int)floor((u + reach / a->at.width) * RIDDLE_IO__RASTER_X);
    int j0 = (int)floor((v - reach / a->at.height) * RIDDLE_IO__RASTER_Y),
        j1 = (int)floor((v + reach / a->at.height) * RIDDLE_IO__RASTER_Y);
    for (int j = j0 < 0 ? 0 : j0; j <= j1 && j < RIDDLE_IO__RASTER_Y; j++)
        for (int i = i0 < 0 ? 0 : i0; i <= i1 && i < RIDDLE_IO__RASTER_X; i++) r[j][i] = true;
}

static inline void riddle_io__stain_segment(riddle_io__raster r, const riddle_io__panel *a, double x0, double y0, double x1, double y1) {
    double longest = fmax(fabs(x1 - x0) / a->at.width * RIDDLE_IO__RASTER_X, fabs(y1 - y0) / a->at.height * RIDDLE_IO__RASTER_Y);
    int steps = 1 + (int)fmin(2.0 * longest, 2000.0);
    for (int k = 0; k <= steps; k++) riddle_io__stain(r, a, x0 + (x1 - x0) * k / steps, y0 + (y1 - y0) * k / steps, 3.0);
}

static inline void riddle_io__stain_series(riddle_io__raster r, const riddle_io__panel *a, const riddle_io__series *s) {
    if (s->kind == RIDDLE_IO__HEAT) {
        memset(r, 1, sizeof(riddle_io__raster));
        return;
    }
    for (int i = 0; i < s->n; i++) {
        if (s->kind == RIDDLE_IO__DISCS) {
            if (riddle_io__visible(a, s->x[i], s->y[i]))
                riddle_io__stain(r, a, riddle_io__limited(riddle_io__px(a, s->x[i])), riddle_io__limited(riddle_io__py(a, s->y[i])),
                                 riddle_io__disc_radius(a, s, i));
        } else if (s->kind == RIDDLE_IO__BARS) {
            double left, right;
            if (!riddle_io__can_show(&a->y, s->y[i])) continue;
            riddle_io__bar_edges(a, s, i, &left, &right);
            double base = a->y.log ? a->y.low : fmax(0.0, a->y.low);
            for (int k = 0; k <= 8; k++) {
                double x = riddle_io__px(a, left + (right - left) * k / 8.0);
                riddle_io__stain_segment(r, a, x, riddle_io__limited(riddle_io__py(a, base)), x,
                                         riddle_io__limited(riddle_io__py(a, s->y[i])));
            }
        } else if (s->kind == RIDDLE_IO__HORIZONTAL && riddle_io__can_show(&a->y, s->y[i])) {
            double y = riddle_io__limited(riddle_io__py(a, s->y[i])), end = a->at.x + a->at.width;
            riddle_io__stain_segment(r, a, a->at.x, y, end, y);
            if (s->label)
                for (int k = 0; k < 3; k++)
                    riddle_io__stain_segment(r, a, end - riddle_io__text_width(s->label, RIDDLE_IO__TICK_SIZE) - 6.0, y - 7.0 * k, end,
                                             y - 7.0 * k);
        } else if (s->kind == RIDDLE_IO__VERTICAL && riddle_io__can_show(&a->x, s->x[i])) {
            double x = riddle_io__limited(riddle_io__px(a, s->x[i]));
            riddle_io__stain_segment(r, a, x, a->at.y, x, a->at.y + a->at.height);
            if (s->label && *s->label) {
                double width = riddle_io__text_width(s->label, RIDDLE_IO__TICK_SIZE) + 10.0,
                       start = x + width < a->at.x + a->at.width ? x : x - width;
                for (int k = 0; k < 3; k++) riddle_io__stain_segment(r, a, start, a->at.y + 7.0 * k, start + width, a->at.y + 7.0 * k);
            }
        } else if (s->kind == RIDDLE_IO__TEXT || s->kind == RIDDLE_IO__TEXT_SHARE) {
            double x, y;
            for (int k = 0; k < 3 && s->label && riddle_io__text_place(a, s, &x, &y); k++)
                riddle_io__stain_segment(r, a, x, y - 6.0 * k, x + riddle_io__text_width(s->label, RIDDLE_IO__TICK_SIZE), y - 6.0 * k);
        } else if (s->kind <= RIDDLE_IO__ERROR_BARS && riddle_io__visible(a, s->x[i], s->y[i])) {
            double x = riddle_io__limited(riddle_io__px(a, s->x[i])), y = riddle_io__limited(riddle_io__py(a, s->y[i]));
            riddle_io__stain(r, a, x, y, s->kind == RIDDLE_IO__LINE && !(s->flags & RIDDLE_IO_MARKED) ? 3.0 : 6.0);
            if (s->kind == RIDDLE_IO__ERROR_BARS && riddle_io__has_length(s, i))
                riddle_io__stain_segment(r, a, x, riddle_io__limited(riddle_io__py(a, s->y[i] + s->z[i])), x,
                                         riddle_io__limited(riddle_io__py(a, riddle_io__floor_of(&a->y, s->y[i] - s->z[i]))));
            if (s->kind == RIDDLE_IO__BAND && riddle_io__can_show(&a->y, s->z[i]))
                riddle_io__stain_segment(r, a, x, y, x, riddle_io__limited(riddle_io__py(a, s->z[i])));
            bool joined = s->kind == RIDDLE_IO__LINE || s->kind == RIDDLE_IO__BAND;
            if (joined && i + 1 < s->n && riddle_io__visible(a, s->x[i + 1], s->y[i + 1])) {
                riddle_io__stain_segment(r, a, x, y, riddle_io__limited(riddle_io__px(a, s->x[i + 1])),
                                         riddle_io__limited(riddle_io__py(a, s->y[i + 1])));
                if (s->kind == RIDDLE_IO__BAND && riddle_io__visible(a, s->x[i + 1], s->z[i + 1]) && riddle_io__can_show(&a->y, s->z[i]))
                    riddle_io__stain_segment(r, a, x, riddle_io__limited(riddle_io__py(a, s->z[i])),
                                             riddle_io__limited(riddle_io__px(a, s->x[i + 1])),
                                             riddle_io__limited(riddle_io__py(a, s->z[i + 1])));
            }
        }
    }
}

/* Finds a free place inside for the legend, nearest to a corner, the right ones first. */
static inline bool riddle_io__place_inside(riddle_io__panel *a) {
    riddle_io__raster r;
    memset(r, 0, sizeof r);
    for (int k = 0; k < a->n; k++) riddle_io__stain_series(r, a, &a->all[k]);
    int w = (int)ceil(a->at.legend_width / a->at.width * RIDDLE_IO__RASTER_X) + 1,
        h = (int)ceil(a->at.legend_height / a->at.height * RIDDLE_IO__RASTER_Y) + 1;
    double best = HUGE_VAL;
    for (int j = 1; j + h < RIDDLE_IO__RASTER_Y; j++)
        for (int i = 1; i + w < RIDDLE_IO__RASTER_X; i++) {
            bool free_place = true;
            for (int jj = j; jj < j + h && free_place; jj++)
                for (int ii = i; ii < i + w && free_place; ii++) free_place = !r[jj][ii];
            if (!free_place) continue;
            int from_right = RIDDLE_IO__RASTER_X - 1 - (i + w), from_bottom = RIDDLE_IO__RASTER_Y - 1 - (j + h);
            double aside = from_right <= i - 1 ? from_right : i - 1 + 0.4, up = j - 1 <= from_bottom ? j - 1 : from_bottom + 0.8;
            if (aside * aside + up * up < best) {
                best = aside * aside + up * up;
                a->at.legend_x = a->at.x + a->at.width * i / RIDDLE_IO__RASTER_X;
                a->at.legend_y = a->at.y + a->at.height * j / RIDDLE_IO__RASTER_Y;
            }
        }
    return best < HUGE_VAL;
}

/* Lays out a panel, except for its place in the figure: it starts at 0, 0. */
static inline void riddle_io__lay_out(const riddle_io_plot *p, riddle_io__panel *a) {
    riddle_io__tick ticks[RIDDLE_IO__MOST_TICKS];
    int exponent, n, entries = 0;
    a->at.width = p->width;
    a->at.height = p->height;
    a->at.x = a->at.y = 0.0;
    riddle_io__find_ranges(a);
    riddle_io__keep_equal(a);
    double widest = 0.0;
    n = riddle_io__make_ticks(&a->y, riddle_io__ticks_along(a->at.height, 48.0), ticks, &exponent);
    for (int i = 0; i < n; i++)
        if (ticks[i].major) widest = fmax(widest, 0.58 * RIDDLE_IO__TICK_SIZE * ticks[i].letters);
    a->at.left = 14.0 + widest + (a->y.label ? RIDDLE_IO__LABEL_SIZE + 12.0 : 0.0);
    a->at.top = (a->title ? RIDDLE_IO__TITLE_SIZE + 12.0 : 8.0) + (exponent ? 14.0 : 0.0);
    a->at.bottom = 28.0 + (a->x.label ? RIDDLE_IO__LABEL_SIZE + 12.0 : 0.0);
    a->at.right = 20.0;
    const riddle_io__series *bars = riddle_io__first_of(a, RIDDLE_IO__BARS), *heat = riddle_io__first_of(a, RIDDLE_IO__HEAT);
    if (bars && riddle_io__slanted_names(a, bars)) {
        double longest = 0.0;
        for (int i = 0; i < bars->n; i++)
            if (bars->names && bars->names[i]) longest = fmax(longest, riddle_io__text_width(bars->names[i], RIDDLE_IO__TICK_SIZE));
        a->at.bottom += 0.55 * longest;
        a->at.left = fmax(a->at.left, 0.84 * longest - 0.5 * a->at.width / bars->n + 10.0);
    }
    if (heat) {
        double low, high, digits = 0.0;
        riddle_io__heat_range(heat, &low, &high);
        riddle_io__axis scale = {low, high, false, false, NULL};
        n = riddle_io__make_ticks(&scale, 5, ticks, &exponent);
        for (int i = 0; i < n; i++)
            if (ticks[i].major) digits = fmax(digits, 0.58 * RIDDLE_IO__TICK_SIZE * ticks[i].letters);
        a->at.right += 16.0 + 23.0 + digits + (heat->label && *heat->label ? 26.0 : 0.0);
    }
    double in_a_row = 0.0;
    a->at.legend_width = 0.0;
    for (int k = 0; k < a->n; k++)
        if (riddle_io__in_legend(&a->all[k])) {
            entries++;
            a->at.legend_width = fmax(a->at.legend_width, riddle_io__entry_width(&a->all[k]));
            in_a_row += riddle_io__entry_width(&a->all[k]);
        }
    a->at.legend_height = entries * RIDDLE_IO__LEGEND_ROW + RIDDLE_IO__PAD;
    if (!entries || (!a->legend_outside && riddle_io__place_inside(a))) return;
    a->legend_above = !a->legend_outside && in_a_row < a->at.width - 30.0; /* the left end may hold the axis' exponent */
    if (a->legend_above) {
        a->at.legend_x = a->at.width - in_a_row;
        a->at.legend_y = -RIDDLE_IO__LEGEND_ROW - RIDDLE_IO__PAD / 2.0;
        a->at.top = (a->title ? RIDDLE_IO__TITLE_SIZE + 8.0 : 0.0) + RIDDLE_IO__LEGEND_ROW + RIDDLE_IO__PAD;
    } else {
        a->legend_outside = true;
        a->at.legend_x = a->at.width + a->at.right - 6.0;
        a->at.legend_y = 0.0;
        a->at.right += a->at.legend_width + 4.0;
        a->at.bottom = fmax(a->at.bottom, a->at.legend_height - a->at.height + 8.0);
    }
}

static inline void riddle_io__draw_axes(riddle_io_file *f, const riddle_io__panel *a) {
    riddle_io__tick ticks[RIDDLE_IO__MOST_TICKS];
    const riddle_io__layout *at = &a->at;
    const riddle_io__series *bars = riddle_io__first_of(a, RIDDLE_IO__BARS);
    int exponent, n;
    riddle_io_print(f, "<g class=\"grid\">\n");
    if (!bars) {
        n = riddle_io__make_ticks(&a->x, riddle_io__ticks_along(at->width, 78.0), ticks, &exponent);
        for (int i = 0; i < n; i++)
            riddle_io_print(f, "<path%s d=\"M%.2f %.1fv%.1f\"/>\n", ticks[i].major ? "" : " class=\"minor\"", riddle_io__px(a, ticks[i].at),
                            at->y, at->height);
    }
    n = riddle_io__make_ticks(&a->y, riddle_io__ticks_along(at->height, 48.0), ticks, &exponent);
    for (int i = 0; i < n; i++)
        riddle_io_print(f, "<path%s d=\"M%.1f %.2fh%.1f\"/>\n", ticks[i].major ? "" : " class=\"minor\"", at->x,
                        riddle_io__py(a, ticks[i].at), at->width);
    riddle_io_print(f, "</g>\n");
}

/* Draws the names of the groups below the frame. Returns the room that slanted ones take. */
static inline double riddle_io__draw_names(riddle_io_file *f, const riddle_io__panel *a, const riddle_io__series *bars) {
    bool slanted = riddle_io__slanted_names(a, bars);
    double room = 0.0, base = a->at.y + a->at.height;
    for (int i = 0; i < bars->n && bars->names; i++) {
        const char *name = bars->names[i] ? bars->names[i] : "";
        if (slanted) room = fmax(room, 0.55 * riddle_io__text_width(name, RIDDLE_IO__TICK_SIZE));
        riddle_io_print(f, "<text class=\"tick\" text-anchor=\"%s\" transform=\"translate(%.1f %.1f)%s\">", slanted ? "end" : "middle",
                        riddle_io__px(a, (double)i) + (slanted ? 5.0 : 0.0), base + (slanted ? 14.0 : 20.0), slanted ? " rotate(-33)" : "");
        riddle_io__escaped(f, name);
        riddle_io_print(f, "</text>\n");
    }
    return room;
}

static inline void riddle_io__draw_x_numbers(riddle_io_file *f, const riddle_io__panel *a) {
    riddle_io__tick ticks[RIDDLE_IO__MOST_TICKS];
    int exponent, n = riddle_io__make_ticks(&a->x, riddle_io__ticks_along(a->at.width, 78.0), ticks, &exponent);
    double free_from = -HUGE_VAL, base = a->at.y + a->at.height;
    for (int i = 0; i < n; i++) {
        double x = riddle_io__px(a, ticks[i].at), half = 0.29 * RIDDLE_IO__TICK_SIZE * ticks[i].letters;
        if (!ticks[i].major || x - half < free_from) continue;
        free_from = x + half + 5.0;
        riddle_io_print(
            f, "<path class=\"mark\" d=\"M%.2f %.1fv5\"/><text x=\"%.2f\" y=\"%.1f\" text-anchor=\"middle\" class=\"tick\">%s</text>\n", x,
            base, x, base + 21.0, ticks[i].text);
    }
    riddle_io__power_of_ten(f, a->at.x + a->at.width + 14.0, base + 40.0, "end", exponent);
}

/* Returns the exponent that stands above the axis. */
static inline int riddle_io__draw_y_numbers(riddle_io_file *f, const riddle_io__panel *a) {
    riddle_io__tick ticks[RIDDLE_IO__MOST_TICKS];
    int exponent, n = riddle_io__make_ticks(&a->y, riddle_io__ticks_along(a->at.height, 48.0), ticks, &exponent);
    double widest = 0.0, free_below = HUGE_VAL;
    for (int i = 0; i < n; i++) {
        double y = riddle_io__py(a, ticks[i].at);
        if (!ticks[i].major || y > free_below) continue;
        free_below = y - RIDDLE_IO__TICK_SIZE - 1.0;
        widest = fmax(widest, 0.58 * RIDDLE_IO__TICK_SIZE * ticks[i].letters);
        riddle_io_print(
            f, "<path class=\"mark\" d=\"M%.1f %.2fh-5\"/><text x=\"%.1f\" y=\"%.2f\" text-anchor=\"end\" class=\"tick\">%s</text>\n",
            a->at.x, y, a->at.x - 9.0, y + 5.0, ticks[i].text);
    }
    riddle_io__power_of_ten(f, a->at.x - 8.0, a->at.y - 7.0, "start", exponent);
    if (a->y.label && *a->y.label)
        riddle_io__upright_label(f, a->at.x - 14.0 - widest - 8.0, a->at.y + 0.5 * a->at.height, a->at.height + 24.0, a->y.label);
    return exponent;
}

static inline void riddle_io__draw_frame(riddle_io_file *f, const riddle_io__panel *a) {
    const riddle_io__layout *at = &a->at;
    const riddle_io__series *bars = riddle_io__first_of(a, RIDDLE_IO__BARS);
    double names = 0.0, above = 10.0;
    riddle_io_print(f, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" class=\"frame\"/>\n", at->x, at->y, at->width,
                    at->height);
    if (bars) names = riddle_io__draw_names(f, a, bars);
    else riddle_io__draw_x_numbers(f, a);
    int exponent = riddle_io__draw_y_numbers(f, a);
    riddle_io__text_at(f, at->x + 0.5 * at->width, at->y + at->height + 28.0 + RIDDLE_IO__LABEL_SIZE + names, "middle", "label",
                       a->x.label);
    if (a->legend_above) above += RIDDLE_IO__LEGEND_ROW;
    else if (exponent) above += 14.0;
    riddle_io__text_at(f, at->x, at->y - above, "start", "title", a->title);
}

static inline void riddle_io__draw_legend(riddle_io_file *f, const riddle_io__panel *a) {
    const riddle_io__layout *at = &a->at;
    double x = at->legend_x + RIDDLE_IO__PAD, y = at->legend_y + RIDDLE_IO__PAD / 2.0;
    int entries = 0;
    for (int k = 0; k < a->n; k++) entries += riddle_io__in_legend(&a->all[k]);
    if (!entries) return;
    if (!a->legend_outside && !a->legend_above)
        riddle_io_print(f, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" rx=\"4\" fill=\"white\" fill-opacity=\"0.85\"/>\n",
                        at->legend_x, at->legend_y, at->legend_width, at->legend_height);
    for (int k = 0; k < a->n; k++) {
        const riddle_io__series *s = &a->all[k];
        if (!riddle_io__in_legend(s)) continue;
        double middle = y + RIDDLE_IO__LEGEND_ROW / 2.0;
        const char *dash = s->flags & RIDDLE_IO_DASHED   ? " stroke-dasharray=\"8 5\""
                           : s->flags & RIDDLE_IO_DOTTED ? " stroke-dasharray=\"2 4\""
                                                         : "";
        if (s->kind == RIDDLE_IO__LINE && !(s->flags & RIDDLE_IO_NO_LINE))
            riddle_io_print(f, "<path d=\"M%.1f %.1fh%.0f\" stroke=\"%s\" stroke-width=\"%s\" stroke-linecap=\"round\"%s%s/>\n", x, middle,
                            RIDDLE_IO__SWATCH, riddle_io__colour_of(s), s->flags & RIDDLE_IO_THIN ? "1.1" : "2.4", dash,
                            s->flags & RIDDLE_IO_FAINT ? " stroke-opacity=\"0.35\"" : "");
        if (s->kind == RIDDLE_IO__POINTS || s->kind == RIDDLE_IO__ERROR_BARS ||
            (s->kind == RIDDLE_IO__LINE && s->flags & RIDDLE_IO_MARKED)) {
            riddle_io_print(f, "<g fill=\"%s\">", riddle_io__colour_of(s));
            riddle_io__draw_marker(f, s, x + RIDDLE_IO__SWATCH / 2.0, middle, 4.0);
            riddle_io_print(f, "</g>");
        }
        if (s->kind == RIDDLE_IO__DISCS)
            riddle_io_print(f, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"8\" fill=\"url(#ball%s)\"/>\n", x + RIDDLE_IO__SWATCH / 2.0, middle,
                            riddle_io__colour_of(s) + 1);
        if (s->kind == RIDDLE_IO__BAND || s->kind == RIDDLE_IO__BARS)
            riddle_io_print(f, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.0f\" height=\"12\" fill=\"%s\"%s/>\n", x, middle - 6.0,
                            RIDDLE_IO__SWATCH, riddle_io__colour_of(s), s->kind == RIDDLE_IO__BAND ? " fill-opacity=\"0.22\"" : "");
        riddle_io__text_at(f, x + RIDDLE_IO__SWATCH + RIDDLE_IO__PAD, middle + 5.0, "start", "note", s->label);
        if (a->legend_above) x += riddle_io__entry_width(s);
        else y += RIDDLE_IO__LEGEND_ROW;
    }
}

static inline void riddle_io__draw_panel(riddle_io_file *f, const riddle_io__panel *a, int number) {
    const riddle_io__series *heat = riddle_io__first_of(a, RIDDLE_IO__HEAT);
    riddle_io_print(f, "<clipPath id=\"c%d\"><rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/></clipPath>\n", number, a->at.x,
                    a->at.y, a->at.width, a->at.height);
    if (!heat) riddle_io__draw_axes(f, a);
    /* markers on the edge are drawn whole, what can leave the panel is cut */
    riddle_io_print(f, "<g clip-path=\"url(#c%d)\">\n", number);
    for (int k = 0; k < a->n; k++)
        if (a->all[k].kind != RIDDLE_IO__POINTS && a->all[k].kind < RIDDLE_IO__TEXT) riddle_io__draw_series(f, a, &a->all[k]);
    riddle_io_print(f, "</g>\n");
    riddle_io__draw_frame(f, a);
    for (int k = 0; k < a->n; k++)
        if (a->all[k].kind == RIDDLE_IO__POINTS || a->all[k].kind >= RIDDLE_IO__TEXT) riddle_io__draw_series(f, a, &a->all[k]);
    if (heat) riddle_io__draw_colour_bar(f, a, heat);
    riddle_io__draw_legend(f, a);
}

static inline const char *riddle_io__style(void) {
    return "<style>text{font-family:Inter,'Helvetica Neue',Helvetica,Arial,'Liberation Sans','DejaVu Sans',sans-serif;fill:#222}"
           ".tick{font-size:14px;fill:#333}.label{font-size:15px}.title{font-size:16px;font-weight:600}.head{font-weight:600}"
           ".note{font-size:14px;paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}" /* legible on bars */
           ".up{font-size:10px}.grid path{stroke:#dcdcdc;stroke-width:1}"
           ".grid .minor{stroke:#f1f1f1}.frame{fill:none;stroke:#444;stroke-width:1.2}.mark{stroke:#444;stroke-width:1.2}</style>\n";
}

/* Gives every panel its place; panels of a column stand below each other, those of a row beside each other. */
static inline void riddle_io__place_panels(riddle_io_plot *p, double head, double *width, double *height) {
    double column_left[6] = {0}, column_right[6] = {0}, row_top[6] = {0}, row_bottom[6] = {0};
    for (int i = 0; i < p->rows * p->columns; i++) {
        riddle_io__panel *a = &p->panels[i];
        int r = i / p->columns, c = i % p->columns;
        if (!a->used) continue;
        riddle_io__lay_out(p, a);
        column_left[c] = fmax(column_left[c], a->at.left);
        column_right[c] = fmax(column_right[c], a->at.right);
        row_top[r] = fmax(row_top[r], a->at.top);
        row_bottom[r] = fmax(row_bottom[r], a->at.bottom);
    }
    *height = head;
    for (int r = 0; r < p->rows; r++) {
        *width = 4.0;
        for (int c = 0; c < p->columns; c++) {
            riddle_io__panel *a = &p->panels[r * p->columns + c];
            double x = *width + column_left[c], y = *height + row_top[r];
            a->at.x += x;
            a->at.y += y;
            a->at.legend_x += x;
            a->at.legend_y += y;
            *width = x + p->width + column_right[c];
        }
        *height += row_top[r] + p->height + row_bottom[r] + 6.0;
    }
    *width += 6.0;
}

RIDDLE_IO_API riddle_io_status riddle_io_plot_write(riddle_io_plot *p, const char *folder, const char *name) {
    if (!p) return RIDDLE_IO_BAD_ARGUMENT;
    if (p->failed) {
        riddle_io_plot_free(p);
        return riddle_io__no_memory(name);
    }
    double width = 0.0, height = 0.0;
    riddle_io__place_panels(p, p->title && *p->title ? 38.0 : 4.0, &width, &height);
    /* a title that is too long for the figure gets smaller letters; bold ones are a quarter wider */
    double title_size = 19.0, title_width = p->title ? 1.25 * riddle_io__text_width(p->title, title_size) + 30.0 : 0.0;
    if (title_width > width) title_size = fmax(13.0, title_size * width / title_width);
    width = fmax(width, title_width * title_size / 19.0);
    riddle_io_file *f = riddle_io_open(folder, name);
    if (!f) {
        riddle_io_plot_free(p);
        return RIDDLE_IO_NOT_WRITTEN;
    }
    riddle_io_print(f, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\">\n", width,
                    height, width, height);
    riddle_io_print(f, "%s<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n", riddle_io__style());
    if (p->title) {
        riddle_io_print(f, "<text x=\"16\" y=\"27\" class=\"head\" font-size=\"%.1f\">", title_size);
        riddle_io__escaped(f, p->title);
        riddle_io_print(f, "</text>\n");
    }
    for (int i = 0; i < p->rows * p->columns; i++)
        if (p->panels[i].used) riddle_io__draw_panel(f, &p->panels[i], i);
    riddle_io_print(f, "</svg>\n");
    riddle_io_plot_free(p);
    return riddle_io_close(f);
}

/* =============================================== >>tables and progress: bodies ============================================== */

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
        fprintf(stream, "%*s%s%*s", left[column] || (last && !*at) ? 0 : pad, "", at, left[column] && !last ? pad : 0, "");
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
