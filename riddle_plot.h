/* riddle_plot.h: figures as SVG: lines, points, bands, error bars, bars, heat maps, discs to scale. A file is whole or
   absent.

   #include "riddle_plot.h"

   int main(void) {
       double time[] = {0, 1, 2}, height[] = {1.0, 0.5, 0.8};
       riddle_plot *figure = riddle_plot_new("A ball that jumps", 1, 1);
       riddle_plot_panel(figure, 0, 0, "time [s]", "height [m]");
       riddle_plot_line(figure, "ball", time, height, 3);
       return riddle_plot_write(figure, NULL, "/dev/null");                    // folder and file: "out", "ball.svg"
   }

   Figures  SVG 1.1: panels in rows and columns; axes, units, a legend that keeps off the data. Colours: Okabe & Ito
            (2008); van der Walt & Smith (2015).
   Units    the caller's: labels are written as they are given. Lengths of figures are in points (1/72 inch). Numbers
            have a decimal point, whatever locale the host has set.
   Errors   a function that fails hands one line to RIDDLE_IO_FAIL, and nothing half written is left. Every function
            takes the NULL that riddle_plot_new returned and does nothing. A figure that ran out of memory says so when
            it is written.
   Hooks    those of riddle_io.h, set before the inclusion: RIDDLE_IO_FAIL, RIDDLE_IO_REALLOC, RIDDLE_IO_FREE.
   Memory   a figure lives from riddle_plot_new to riddle_plot_write or riddle_plot_free. Data given to it are copied.
   Threads  no state but the caller's figures: one figure is used by one thread at a time.
   Bits     the same calls give the same file with the same C library.
   Linking  with riddle_io.h beside it. Every function is static inline; for one shared copy #define RIDDLE_PLOT_API
            extern before every inclusion, and RIDDLE_PLOT_IMPLEMENTATION as well in one file; riddle_io.h has its own
            switch.
   Not here: other formats than SVG, three dimensions, dates on an axis. */
#ifndef RIDDLE_PLOT_H
#define RIDDLE_PLOT_H

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "riddle_plot.h needs NaN and infinity: compile without -ffast-math"
#endif

#include "riddle_io.h"

#ifndef RIDDLE_PLOT_API
#define RIDDLE_PLOT_API static inline
#define RIDDLE_PLOT__BODIES
#elif defined(RIDDLE_PLOT_IMPLEMENTATION)
#define RIDDLE_PLOT__BODIES
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ================================================= >>declarations ================================================= */

/* Values that are not finite (or not positive on a log axis) are left out and break a line. Text is UTF-8 and is
   escaped. Panels without a call stay empty. A series with the label NULL or "" is not in the legend. */
typedef struct riddle_plot riddle_plot;

/* title may be NULL; 1 to 6 rows and columns */
RIDDLE_PLOT_API riddle_plot *riddle_plot_new(const char *title, int rows, int columns);
/* Of each; default 540 x 360 for one panel. */
RIDDLE_PLOT_API void riddle_plot_panel_size(riddle_plot *p, double width, double height);
/* Always frees the figure. */
RIDDLE_PLOT_API riddle_io_status riddle_plot_write(riddle_plot *p, const char *folder, const char *name);
/* Instead of writing it. */
RIDDLE_PLOT_API void riddle_plot_free(riddle_plot *p);

/* Chooses the panel that the following calls work on. */
RIDDLE_PLOT_API void riddle_plot_panel(riddle_plot *p, int row, int column, const char *x_label, const char *y_label);
RIDDLE_PLOT_API void riddle_plot_title(riddle_plot *p, const char *title); /* of the panel */
RIDDLE_PLOT_API void riddle_plot_log_x(riddle_plot *p);
RIDDLE_PLOT_API void riddle_plot_log_y(riddle_plot *p);
/* default: the data with a small margin */
RIDDLE_PLOT_API void riddle_plot_range_x(riddle_plot *p, double low, double high);
RIDDLE_PLOT_API void riddle_plot_range_y(riddle_plot *p, double low, double high);
RIDDLE_PLOT_API void riddle_plot_equal(riddle_plot *p);          /* same length for one unit on both axes */
/* Says that the panel is drawn to scale, as a section of a machine: as riddle_plot_equal, and a bar of a round length
   in the given unit, such as "mm", instead of axes and their labels. NULL: axes. */
RIDDLE_PLOT_API void riddle_plot_scale_bar(riddle_plot *p, const char *unit);
/* Returns the length of such a bar: 1, 2 or 5 times a power of ten, at most `most` (above 0). */
RIDDLE_PLOT_API double riddle_plot_round_length(double most);
/* right of the panel; default: inside where no data are, else outside */
RIDDLE_PLOT_API void riddle_plot_legend_outside(riddle_plot *p);

/* Add a series of n points. Each takes the next colour. */
RIDDLE_PLOT_API void riddle_plot_line(riddle_plot *p, const char *label, const double *x, const double *y, int n);
RIDDLE_PLOT_API void riddle_plot_points(riddle_plot *p, const char *label, const double *x, const double *y, int n);
RIDDLE_PLOT_API void riddle_plot_band(riddle_plot *p, const char *label, const double *x, const double *low,
                                      const double *high, int n);
RIDDLE_PLOT_API void riddle_plot_error_bars(riddle_plot *p, const char *label, const double *x, const double *y,
                                            const double *plus_minus, int n);
/* Adds shaded discs, for spheres to scale: x, y and radius in the axes' unit; with riddle_plot_equal. They are drawn in
   the given order. */
RIDDLE_PLOT_API void riddle_plot_discs(riddle_plot *p, const char *label, const double *x, const double *y,
                                       const double *radius, int n);
/* Adds bars beside each other, one group for each name; call again for the next series of the same groups. */
RIDDLE_PLOT_API void riddle_plot_bars(riddle_plot *p, const char *label, const char *const *names, const double *values,
                                      int n);
/* Adds a heat map of values[row][column], row 0 at the bottom, between the given corners, and a colour bar with its
   label at the right. */
RIDDLE_PLOT_API void riddle_plot_heat(riddle_plot *p, const char *label, const double *values, int columns, int rows,
                                      double x0, double x1, double y0, double y1);
/* Sets the range of the colours of the heat map just added, for comparing panels; default: the range of its values. */
RIDDLE_PLOT_API void riddle_plot_heat_range(riddle_plot *p, double low, double high);

/* Says that the values of the heat map just added are the classes 0, 1 .. n-1 with these names: the bar shows one
   colour each. */
RIDDLE_PLOT_API void riddle_plot_heat_classes(riddle_plot *p, const char *const *names, int n);

/* The appearance of the series just added. */
enum {
    RIDDLE_PLOT_DASHED = 1,
    RIDDLE_PLOT_DOTTED = 2,
    RIDDLE_PLOT_MARKED = 4,
    RIDDLE_PLOT_THIN = 8,
    RIDDLE_PLOT_FAINT = 16,
    RIDDLE_PLOT_STEPS = 32,
    RIDDLE_PLOT_NO_LINE = 64
};
/* colours; 0 .. 7 from the palette, 8 .. 31 the same with other markers, lines without markers dash-dotted */
enum { RIDDLE_PLOT_NEXT = -1, RIDDLE_PLOT_SAME = -2, RIDDLE_PLOT_GREY = -3, RIDDLE_PLOT_BLACK = -4 };
RIDDLE_PLOT_API void riddle_plot_style(riddle_plot *p, int flags, int colour);

/* Draw reference lines over the whole panel, and text at a place in data coordinates (or at a share 0..1
   of the panel). */
RIDDLE_PLOT_API void riddle_plot_horizontal(riddle_plot *p, const char *label, double y);
RIDDLE_PLOT_API void riddle_plot_vertical(riddle_plot *p, const char *label, double x);
RIDDLE_PLOT_API void riddle_plot_text(riddle_plot *p, double x, double y, const char *text);
RIDDLE_PLOT_API void riddle_plot_text_share(riddle_plot *p, double x_share, double y_share, const char *text);

#ifdef RIDDLE_PLOT__BODIES

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

/* ==================================================== >>bodies ==================================================== */

/* ---- what a figure holds ---- */

typedef enum {
    RIDDLE_PLOT__LINE,
    RIDDLE_PLOT__POINTS,
    RIDDLE_PLOT__BAND,
    RIDDLE_PLOT__ERROR_BARS,
    RIDDLE_PLOT__DISCS,
    RIDDLE_PLOT__BARS,
    RIDDLE_PLOT__HEAT,
    RIDDLE_PLOT__HORIZONTAL,
    RIDDLE_PLOT__VERTICAL,
    RIDDLE_PLOT__TEXT,
    RIDDLE_PLOT__TEXT_SHARE
} riddle_plot__series_kind;

typedef struct {
    riddle_plot__series_kind kind;
    char *label;
    double *x, *y, *z; /* z: upper edge of a band, half-length of an error bar, the two ends of a heat map's colours */
    int n;
    char **names;      /* of the groups of bars, or of the classes of a heat map */
    int named;         /* number of names */
    int columns, rows; /* of a heat map in y, its corners in x[4] */
    int colour, flags;
} riddle_plot__series;

typedef struct {
    double low, high;
    bool log, fixed_range;
    char *label;
} riddle_plot__axis;

typedef struct {
    double x, y, width, height;      /* the data area in the figure */
    double left, right, top, bottom; /* room for what stands around it */
    double legend_x, legend_y, legend_width, legend_height;
} riddle_plot__layout;

typedef struct {
    bool used, equal, legend_outside, legend_above;
    char *title, *unit; /* unit: of the scale bar; NULL: axes */
    riddle_plot__axis x, y;
    riddle_plot__series *all;
    int n, capacity, next_colour;
    riddle_plot__layout at;
} riddle_plot__panel;

struct riddle_plot {
    char *title;
    int rows, columns, chosen;
    double width, height;
    riddle_plot__panel *panels;
    bool failed; /* out of memory */
};

/* Returns a colour of Okabe & Ito (2008), which the colour-blind can tell apart; brown replaces their yellow, which is
   too pale for a line. */
static inline const char *riddle_plot__palette(int colour) {
    static const char *const colours[8] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                           "#E69F00", "#56B4E9", "#7A5C2E", "#555555"};
    return colours[colour & 7];
}

#define RIDDLE_PLOT__TICK_SIZE 14.0 /* of letters; lengths in points */
#define RIDDLE_PLOT__LABEL_SIZE 15.0
#define RIDDLE_PLOT__TITLE_SIZE 16.0
#define RIDDLE_PLOT__LEGEND_ROW 21.0
#define RIDDLE_PLOT__SWATCH 30.0
#define RIDDLE_PLOT__PAD 8.0

/* ---- building ---- */

static inline char *riddle_plot__copy_text(riddle_plot *p, const char *text) {
    if (!text) return NULL;
    size_t size = strlen(text) + 1;
    char *c = (char *)RIDDLE_IO_REALLOC(NULL, size);
    if (c) memcpy(c, text, size);
    else p->failed = true;
    return c;
}

static inline double *riddle_plot__copy_numbers(riddle_plot *p, const double *values, int n) {
    if (!values || n <= 0) return NULL;
    double *c = (double *)RIDDLE_IO_REALLOC(NULL, (size_t)n * sizeof *c);
    if (c) memcpy(c, values, (size_t)n * sizeof *c);
    else p->failed = true;
    return c;
}

RIDDLE_PLOT_API riddle_plot *riddle_plot_new(const char *title, int rows, int columns) {
    riddle_plot *p = (riddle_plot *)riddle_io__zeroed(sizeof *p);
    if (!p) {
        riddle_io__no_memory("a figure");
        return NULL;
    }
    p->rows = rows < 1 ? 1 : rows > 6 ? 6 : rows;
    p->columns = columns < 1 ? 1 : columns > 6 ? 6 : columns;
    p->panels = (riddle_plot__panel *)riddle_io__zeroed((size_t)(p->rows * p->columns) * sizeof *p->panels);
    if (!p->panels) {
        riddle_io__release(p);
        riddle_io__no_memory("a figure");
        return NULL;
    }
    p->title = riddle_plot__copy_text(p, title);
    int most = p->rows > p->columns ? p->rows : p->columns;
    p->width = most == 1 ? 540.0 : most == 2 ? 430.0 : 340.0;
    p->height = most == 1 ? 360.0 : most == 2 ? 300.0 : 245.0;
    return p;
}

RIDDLE_PLOT_API void riddle_plot_panel_size(riddle_plot *p, double width, double height) {
    if (!p) return;
    if (width >= 80.0 && width <= 4000.0) p->width = width;
    if (height >= 60.0 && height <= 4000.0) p->height = height;
}

static inline void riddle_plot__free_series(riddle_plot__series *s) {
    riddle_io__release(s->label);
    riddle_io__release(s->x);
    riddle_io__release(s->y);
    riddle_io__release(s->z);
    for (int i = 0; s->names && i < s->named; i++) riddle_io__release(s->names[i]);
    riddle_io__release(s->names);
}

RIDDLE_PLOT_API void riddle_plot_free(riddle_plot *p) {
    if (!p) return;
    for (int i = 0; i < p->rows * p->columns; i++) {
        riddle_plot__panel *a = &p->panels[i];
        for (int k = 0; k < a->n; k++) riddle_plot__free_series(&a->all[k]);
        riddle_io__release(a->all);
        riddle_io__release(a->title);
        riddle_io__release(a->unit);
        riddle_io__release(a->x.label);
        riddle_io__release(a->y.label);
    }
    riddle_io__release(p->panels);
    riddle_io__release(p->title);
    riddle_io__release(p);
}

static inline riddle_plot__panel *riddle_plot__current(riddle_plot *p) {
    if (!p) return NULL;
    p->panels[p->chosen].used = true;
    return &p->panels[p->chosen];
}

RIDDLE_PLOT_API void riddle_plot_panel(riddle_plot *p, int row, int column, const char *x_label, const char *y_label) {
    if (!p || row < 0 || row >= p->rows || column < 0 || column >= p->columns) return;
    p->chosen = row * p->columns + column;
    riddle_plot__panel *a = riddle_plot__current(p);
    riddle_io__release(a->x.label);
    riddle_io__release(a->y.label);
    a->x.label = riddle_plot__copy_text(p, x_label);
    a->y.label = riddle_plot__copy_text(p, y_label);
}

RIDDLE_PLOT_API void riddle_plot_title(riddle_plot *p, const char *title) {
    riddle_plot__panel *a = riddle_plot__current(p);
    if (!a) return;
    riddle_io__release(a->title);
    a->title = riddle_plot__copy_text(p, title);
}

RIDDLE_PLOT_API void riddle_plot_log_x(riddle_plot *p) {
    riddle_plot__panel *a = riddle_plot__current(p);
    if (a) a->x.log = true;
}

RIDDLE_PLOT_API void riddle_plot_log_y(riddle_plot *p) {
    riddle_plot__panel *a = riddle_plot__current(p);
    if (a) a->y.log = true;
}

static inline void riddle_plot__set_range(riddle_plot__axis *a, double low, double high) {
    if (!(low < high) || !(high - low < HUGE_VAL)) return;
    a->low = low;
    a->high = high;
    a->fixed_range = true;
}

RIDDLE_PLOT_API void riddle_plot_range_x(riddle_plot *p, double low, double high) {
    riddle_plot__panel *a = riddle_plot__current(p);
    if (a) riddle_plot__set_range(&a->x, low, high);
}

RIDDLE_PLOT_API void riddle_plot_range_y(riddle_plot *p, double low, double high) {
    riddle_plot__panel *a = riddle_plot__current(p);
    if (a) riddle_plot__set_range(&a->y, low, high);
}

RIDDLE_PLOT_API void riddle_plot_equal(riddle_plot *p) {
    riddle_plot__panel *a = riddle_plot__current(p);
    if (a) a->equal = true;
}

RIDDLE_PLOT_API void riddle_plot_scale_bar(riddle_plot *p, const char *unit) {
    riddle_plot__panel *a = riddle_plot__current(p);
    if (!a) return;
    riddle_io__release(a->unit);
    a->unit = riddle_plot__copy_text(p, unit);
    a->equal = a->equal || unit;
}

RIDDLE_PLOT_API void riddle_plot_legend_outside(riddle_plot *p) {
    riddle_plot__panel *a = riddle_plot__current(p);
    if (a) a->legend_outside = true;
}

static inline riddle_plot__series *riddle_plot__add(riddle_plot *p, riddle_plot__series_kind kind, const char *label,
                                                    int n) {
    riddle_plot__panel *a = riddle_plot__current(p);
    if (!a) return NULL;
    if (a->n == a->capacity) {
        int capacity = 2 * a->capacity + 8;
        riddle_plot__series *larger =
            (riddle_plot__series *)RIDDLE_IO_REALLOC(a->all, (size_t)capacity * sizeof *larger);
        if (!larger) {
            p->failed = true;
            return NULL;
        }
        a->all = larger;
        a->capacity = capacity;
    }
    riddle_plot__series *s = &a->all[a->n++];
    memset(s, 0, sizeof *s);
    s->kind = kind;
    s->label = riddle_plot__copy_text(p, label);
    s->n = n > 0 ? n : 0;
    s->colour = RIDDLE_PLOT_GREY;
    return s;
}

static inline riddle_plot__series *riddle_plot__add_coloured(riddle_plot *p, riddle_plot__series_kind kind,
                                                             const char *label, const double *x, const double *y,
                                                             const double *z, int n) {
    riddle_plot__series *s = riddle_plot__add(p, kind, label, n);
    if (!s) return NULL;
    s->x = riddle_plot__copy_numbers(p, x, n);
    s->y = riddle_plot__copy_numbers(p, y, n);
    s->z = riddle_plot__copy_numbers(p, z, n);
    if ((!s->x && kind != RIDDLE_PLOT__BARS) || !s->y) s->n = 0;
    if (!s->z && (z || kind == RIDDLE_PLOT__BAND || kind == RIDDLE_PLOT__ERROR_BARS || kind == RIDDLE_PLOT__DISCS))
        s->n = 0;
    s->colour = riddle_plot__current(p)->next_colour++ % 32;
    return s;
}

RIDDLE_PLOT_API void riddle_plot_line(riddle_plot *p, const char *label, const double *x, const double *y, int n) {
    riddle_plot__add_coloured(p, RIDDLE_PLOT__LINE, label, x, y, NULL, n);
}

RIDDLE_PLOT_API void riddle_plot_points(riddle_plot *p, const char *label, const double *x, const double *y, int n) {
    riddle_plot__add_coloured(p, RIDDLE_PLOT__POINTS, label, x, y, NULL, n);
}

RIDDLE_PLOT_API void riddle_plot_band(riddle_plot *p, const char *label, const double *x, const double *low,
                                      const double *high, int n) {
    riddle_plot__add_coloured(p, RIDDLE_PLOT__BAND, label, x, low, high, n);
}

RIDDLE_PLOT_API void riddle_plot_error_bars(riddle_plot *p, const char *label, const double *x, const double *y,
                                            const double *plus_minus, int n) {
    riddle_plot__add_coloured(p, RIDDLE_PLOT__ERROR_BARS, label, x, y, plus_minus, n);
}

RIDDLE_PLOT_API void riddle_plot_discs(riddle_plot *p, const char *label, const double *x, const double *y,
                                       const double *radius, int n) {
    riddle_plot__add_coloured(p, RIDDLE_PLOT__DISCS, label, x, y, radius, n);
}

static inline void riddle_plot__name(riddle_plot *p, riddle_plot__series *s, const char *const *names, int n) {
    s->names = (char **)riddle_io__zeroed((size_t)n * sizeof *s->names);
    s->named = s->names ? n : 0;
    if (!s->names) p->failed = true;
    for (int i = 0; i < s->named; i++) s->names[i] = riddle_plot__copy_text(p, names[i]);
}

RIDDLE_PLOT_API void riddle_plot_bars(riddle_plot *p, const char *label, const char *const *names, const double *values,
                                      int n) {
    riddle_plot__series *s = riddle_plot__add_coloured(p, RIDDLE_PLOT__BARS, label, NULL, values, NULL, n);
    if (!s || !names) {
        if (s) s->n = 0;
        return;
    }
    if (s->n == 0) return;
    riddle_plot__name(p, s, names, s->n);
}

RIDDLE_PLOT_API void riddle_plot_heat(riddle_plot *p, const char *label, const double *values, int columns, int rows,
                                      double x0, double x1, double y0, double y1) {
    double corners[4] = {x0, x1, y0, y1};
    if (columns < 1 || rows < 1 || columns > 100000000 / rows) return;
    riddle_plot__series *s = riddle_plot__add(p, RIDDLE_PLOT__HEAT, label, 4);
    if (!s) return;
    s->x = riddle_plot__copy_numbers(p, corners, 4);
    s->y = riddle_plot__copy_numbers(p, values, columns * rows);
    s->columns = columns;
    s->rows = rows;
    if (!s->x || !s->y) s->n = 0;
}

RIDDLE_PLOT_API void riddle_plot_heat_range(riddle_plot *p, double low, double high) {
    riddle_plot__panel *a = riddle_plot__current(p);
    const double ends[2] = {low, high};
    if (!a || a->n == 0 || a->all[a->n - 1].kind != RIDDLE_PLOT__HEAT || !(low < high) || !(high - low < HUGE_VAL))
        return;
    riddle_io__release(a->all[a->n - 1].z);
    a->all[a->n - 1].z = riddle_plot__copy_numbers(p, ends, 2);
}

RIDDLE_PLOT_API void riddle_plot_heat_classes(riddle_plot *p, const char *const *names, int n) {
    riddle_plot__panel *a = riddle_plot__current(p);
    if (!a || a->n == 0 || a->all[a->n - 1].kind != RIDDLE_PLOT__HEAT || a->all[a->n - 1].names || !names || n < 1 ||
        n > 64)
        return;
    riddle_plot_heat_range(p, -0.5, n - 0.5);
    riddle_plot__name(p, &a->all[a->n - 1], names, n);
}

RIDDLE_PLOT_API void riddle_plot_style(riddle_plot *p, int flags, int colour) {
    riddle_plot__panel *a = riddle_plot__current(p);
    if (!a || a->n == 0) return;
    riddle_plot__series *s = &a->all[a->n - 1];
    s->flags = flags;
    if (colour == RIDDLE_PLOT_NEXT) return;
    if (s->kind <= RIDDLE_PLOT__BARS) a->next_colour--; /* releases the colour that it took */
    if (colour == RIDDLE_PLOT_SAME) s->colour = a->n > 1 ? a->all[a->n - 2].colour : 0;
    else s->colour = colour >= 0 ? colour % 32 : colour;
}

static inline void riddle_plot__add_at(riddle_plot *p, riddle_plot__series_kind kind, const char *label, double x,
                                       double y) {
    riddle_plot__series *s = riddle_plot__add(p, kind, label, 1);
    if (!s) return;
    s->x = riddle_plot__copy_numbers(p, &x, 1);
    s->y = riddle_plot__copy_numbers(p, &y, 1);
    if (!s->x || !s->y) s->n = 0;
}

RIDDLE_PLOT_API void riddle_plot_horizontal(riddle_plot *p, const char *label, double y) {
    riddle_plot__add_at(p, RIDDLE_PLOT__HORIZONTAL, label, 0.0, y);
}

RIDDLE_PLOT_API void riddle_plot_vertical(riddle_plot *p, const char *label, double x) {
    riddle_plot__add_at(p, RIDDLE_PLOT__VERTICAL, label, x, 0.0);
}

RIDDLE_PLOT_API void riddle_plot_text(riddle_plot *p, double x, double y, const char *text) {
    riddle_plot__add_at(p, RIDDLE_PLOT__TEXT, text, x, y);
}

RIDDLE_PLOT_API void riddle_plot_text_share(riddle_plot *p, double x_share, double y_share, const char *text) {
    riddle_plot__add_at(p, RIDDLE_PLOT__TEXT_SHARE, text, x_share, y_share);
}

/* ---- axes ---- */

static inline bool riddle_plot__can_show(const riddle_plot__axis *a, double v) {
    return v - v == 0.0 && (!a->log || v > 0.0);
}

static inline void riddle_plot__include(const riddle_plot__axis *a, double v, double *low, double *high) {
    if (!riddle_plot__can_show(a, v)) return;
    if (v < *low) *low = v;
    if (v > *high) *high = v;
}

/* Sets the range of an axis from the range of its data. */
static inline void riddle_plot__settle(riddle_plot__axis *a, double low, double high, bool tight) {
    if (a->fixed_range && riddle_plot__can_show(a, a->low)) return;
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
static inline double riddle_plot__share(const riddle_plot__axis *a, double v) {
    if (a->log) return (log(v) - log(a->low)) / (log(a->high) - log(a->low)); /* a quotient could overflow */
    return (v - a->low) / (a->high - a->low);
}

typedef struct {
    double at;
    bool major;
    char text[80]; /* SVG, with a raised exponent where needed */
    int letters;
} riddle_plot__tick;

enum { RIDDLE_PLOT__MOST_TICKS = 120 };

static inline void riddle_plot__replace_minus(char *text, size_t size) {
    size_t length = strlen(text);
    if (text[0] != '-' || length + 3 > size) return;
    memmove(text + 3, text + 1, length);
    memcpy(text, "\xE2\x88\x92", 3);
}

/* Returns a step of 1, 2, 5 x 10^k that gives about `wanted` intervals; *minor: intervals between two. */
static inline double riddle_plot__nice_step(double span, int wanted, int *minor) {
    double raw = span / wanted, power = pow(10.0, floor(log10(raw))), m = raw / power;
    *minor = m > 1.41 && m <= 3.16 ? 4 : 5;
    return power * (m <= 1.41 ? 1.0 : m <= 3.16 ? 2.0 : m <= 7.07 ? 5.0 : 10.0);
}

/* Makes the ticks of a linear axis. Returns their number. *exponent: 10^exponent is divided out of the labels and is
   written at the end of the axis. */
static inline int riddle_plot__linear_ticks(const riddle_plot__axis *a, int wanted, riddle_plot__tick *ticks,
                                            int *exponent) {
    int minor, n = 0;
    double step = riddle_plot__nice_step(a->high - a->low, wanted, &minor), fine = step / minor,
           largest = fmax(fabs(a->low), fabs(a->high));
    int size = largest > 0.0 ? (int)floor(log10(largest) + 1e-9) : 0, digits = (int)floor(log10(step) + 1e-9);
    *exponent = size >= 6 || size <= -3 ? 3 * (int)floor(size / 3.0) : 0;
    int decimals = *exponent - digits;
    if (decimals < 0) decimals = 0;
    if (decimals > 12) decimals = 12;
    for (double k = ceil(a->low / fine - 1e-9); k * fine <= a->high + 1e-9 * step && n < RIDDLE_PLOT__MOST_TICKS;
         k += 1.0) {
        riddle_plot__tick *t = &ticks[n++];
        t->at = k * fine;
        t->major = fabs(k / minor - floor(k / minor + 0.5)) < 1e-6;
        double shown = t->at / pow(10.0, *exponent);
        if (fabs(t->at) < 1e-9 * step) shown = 0.0;
        snprintf(t->text, sizeof t->text, "%.*f", decimals, shown);
        riddle_io__use_point(t->text);
        riddle_plot__replace_minus(t->text, sizeof t->text);
        t->letters = riddle_io__letters_of(t->text);
        if (t->at < a->low) t->at = a->low;
        if (t->at > a->high) t->at = a->high;
    }
    return n;
}

/* Writes m x 10^exponent as the text of a tick. */
static inline void riddle_plot__power_text(riddle_plot__tick *t, int m, int exponent, bool plain) {
    char raised[20], front[10] = "";
    if (plain) {
        snprintf(t->text, sizeof t->text, "%.*f", exponent < 0 ? -exponent : 0, m * pow(10.0, exponent));
        riddle_io__use_point(t->text);
        t->letters = (int)strlen(t->text);
        return;
    }
    snprintf(raised, sizeof raised, "%d", exponent);
    riddle_plot__replace_minus(raised, sizeof raised);
    if (m != 1) snprintf(front, sizeof front, "%d\xC3\x97", m % 10);
    snprintf(t->text, sizeof t->text, "%s10<tspan class=\"up\" dy=\"-6\">%s</tspan>", front, raised);
    t->letters = riddle_io__letters_of(front) + 2 + riddle_io__letters_of(raised);
}

static inline int riddle_plot__log_ticks(const riddle_plot__axis *a, int wanted, riddle_plot__tick *ticks) {
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
        for (int m = 1; m <= 9 && n < RIDDLE_PLOT__MOST_TICKS; m++) {
            if (every > 1 && m > 1) continue;
            double v = m * pow(10.0, e);
            if (v < a->low * (1.0 - 1e-9) || v > a->high * (1.0 + 1e-9)) continue;
            riddle_plot__tick *t = &ticks[n++];
            t->at = v;
            t->major = m == 1 && e % every == 0;
            t->letters = 0;
            t->text[0] = '\0';
            /* Too few powers of ten to read it by. */
            if (few && (m == 2 || m == 5 || steps_shown <= 6)) t->major = true;
            if (t->major) riddle_plot__power_text(t, m, e, plain);
        }
    }
    return n;
}

/* Makes the ticks of an axis. A logarithmic axis within a factor of two gets linear ones: it has no useful
   powers of ten. */
static inline int riddle_plot__make_ticks(const riddle_plot__axis *a, int wanted, riddle_plot__tick *ticks,
                                          int *exponent) {
    *exponent = 0;
    if (a->log && a->high / a->low > 2.0) return riddle_plot__log_ticks(a, wanted, ticks);
    return riddle_plot__linear_ticks(a, wanted, ticks, exponent);
}

/* ---- text widths, by the average letters of the widest of the faces that the figures name, DejaVu Sans ---- */

static inline double riddle_plot__text_width(const char *text, double size) {
    double w = 0.0;
    for (; *text; text++) {
        if (((unsigned char)*text & 0xC0) == 0x80) continue;
        w += strchr("iljtfr.,:;'|()[] ", *text) ? 0.35
             : strchr("mwMW", *text)            ? 0.92
             : *text >= 'A' && *text <= 'Z'     ? 0.70
                                                : 0.62;
    }
    return w * size;
}

/* ---- SVG ---- */

static inline void riddle_plot__escaped(riddle_io_file *f, const char *text) {
    for (; text && *text; text++) {
        if (*text == '&') riddle_io_print(f, "&amp;");
        else if (*text == '<') riddle_io_print(f, "&lt;");
        else if (*text == '>') riddle_io_print(f, "&gt;");
        else if ((unsigned char)*text >= 32) riddle_io_write(f, text, 1);
    }
}

static inline void riddle_plot__text_at(riddle_io_file *f, double x, double y, const char *anchor, const char *style,
                                        const char *text) {
    if (!text || !*text) return;
    riddle_io_print(f, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" class=\"%s\">", x, y, anchor, style);
    riddle_plot__escaped(f, text);
    riddle_io_print(f, "</text>\n");
}

/* Draws the factor that was divided out of the numbers of an axis. */
static inline void riddle_plot__power_of_ten(riddle_io_file *f, double x, double y, const char *anchor, int exponent) {
    if (!exponent) return;
    riddle_io_print(f,
                    "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" class=\"tick\">\xC3\x97"
                    "10<tspan class=\"up\" dy=\"-6\">%s%d</tspan></text>\n",
                    x, y, anchor, exponent < 0 ? "\xE2\x88\x92" : "", abs(exponent));
}

/* Returns a font size at which a text fits into its room; at least half the usual one. */
static inline double riddle_plot__fitting(const char *text, double size, double room) {
    double width = riddle_plot__text_width(text, size);
    return width > room ? fmax(0.5 * size, size * room / width) : size;
}

static inline void riddle_plot__upright_label(riddle_io_file *f, double x, double y, double room, const char *text) {
    riddle_io_print(f,
                    "<text transform=\"translate(%.1f %.1f) rotate(-90)\" text-anchor=\"middle\" class=\"label\" "
                    "style=\"font-size:%.1fpx\">",
                    x, y, riddle_plot__fitting(text, RIDDLE_PLOT__LABEL_SIZE, room));
    riddle_plot__escaped(f, text);
    riddle_io_print(f, "</text>\n");
}

static inline const char *riddle_plot__colour_of(const riddle_plot__series *s) {
    if (s->colour == RIDDLE_PLOT_GREY) return "#888888";
    if (s->colour == RIDDLE_PLOT_BLACK) return "#222222";
    return riddle_plot__palette(s->colour);
}

/* Computes the colour of a share 0..1 in the map viridis (van der Walt & Smith 2015), given at nine places. */
static inline void riddle_plot__heat_colour(double share01, int rgb[3]) {
    static const int map[9][3] = {{68, 1, 84},    {71, 44, 122}, {59, 81, 139},  {44, 113, 142}, {33, 144, 141},
                                  {39, 173, 129}, {92, 200, 99}, {170, 220, 50}, {253, 231, 37}};
    double s = share01 < 0.0 ? 0.0 : share01 > 1.0 ? 8.0 : 8.0 * share01;
    int k = s >= 8.0 ? 7 : (int)s;
    for (int i = 0; i < 3; i++) rgb[i] = (int)(map[k][i] + (s - k) * (map[k + 1][i] - map[k][i]) + 0.5);
}

static inline double riddle_plot__px(const riddle_plot__panel *a, double x) {
    return a->at.x + a->at.width * riddle_plot__share(&a->x, x);
}

static inline double riddle_plot__py(const riddle_plot__panel *a, double y) {
    return a->at.y + a->at.height * (1.0 - riddle_plot__share(&a->y, y));
}

static inline bool riddle_plot__visible(const riddle_plot__panel *a, double x, double y) {
    return riddle_plot__can_show(&a->x, x) && riddle_plot__can_show(&a->y, y);
}

/* Limits a coordinate to a range that renderers accept. */
static inline double riddle_plot__limited(double v) { return v < -1e5 ? -1e5 : v > 1e5 ? 1e5 : v; }

static inline const char *riddle_plot__dash_of(const riddle_plot__series *s) {
    if (s->flags & RIDDLE_PLOT_DASHED) return " stroke-dasharray=\"8 5\"";
    if (s->flags & RIDDLE_PLOT_DOTTED) return " stroke-dasharray=\"2 4\"";
    return s->colour > 7 && !(s->flags & RIDDLE_PLOT_MARKED) ? " stroke-dasharray=\"9 4 1 4\"" : "";
}

static inline void riddle_plot__draw_path(riddle_io_file *f, const riddle_plot__panel *a,
                                          const riddle_plot__series *s) {
    double width = s->flags & RIDDLE_PLOT_THIN ? 1.1 : 2.4;
    riddle_io_print(f,
                    "<path fill=\"none\" stroke=\"%s\" stroke-width=\"%.1f\" stroke-linejoin=\"round\" "
                    "stroke-linecap=\"round\"%s%s d=\"",
                    riddle_plot__colour_of(s), width, riddle_plot__dash_of(s),
                    s->flags & RIDDLE_PLOT_FAINT ? " stroke-opacity=\"0.35\"" : "");
    bool pen_down = false;
    double last_x = 0.0, last_y = 0.0;
    for (int i = 0; i < s->n; i++) {
        if (!riddle_plot__visible(a, s->x[i], s->y[i])) {
            pen_down = false;
            continue;
        }
        double x = riddle_plot__limited(riddle_plot__px(a, s->x[i])),
               y = riddle_plot__limited(riddle_plot__py(a, s->y[i]));
        bool last = i + 1 == s->n || !riddle_plot__visible(a, s->x[i + 1], s->y[i + 1]);
        if (pen_down && !last && fabs(x - last_x) < 0.3 && fabs(y - last_y) < 0.3) continue;
        if (pen_down && s->flags & RIDDLE_PLOT_STEPS) riddle_io_print(f, "H%.2f", x);
        riddle_io_print(f, "%s%.2f %.2f", pen_down ? "L" : "M", x, y);
        pen_down = true;
        last_x = x;
        last_y = y;
    }
    riddle_io_print(f, "\"/>\n");
}

/* Draws a marker; each colour has its own shape, for readers who cannot tell the colours apart, and another one where
   it comes again. */
static inline void riddle_plot__draw_marker(riddle_io_file *f, const riddle_plot__series *s, double x, double y,
                                            double r) {
    switch (s->colour < 0 ? 0 : (s->colour + s->colour / 8) % 4) {
    case 1:
        riddle_io_print(f, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\"/>\n", x - 0.9 * r, y - 0.9 * r,
                        1.8 * r, 1.8 * r);
        break;
    case 2:
        riddle_io_print(f, "<path d=\"M%.2f %.2fl%.2f %.2fh%.2fz\"/>\n", x, y - 1.2 * r, 1.15 * r, 2.0 * r, -2.3 * r);
        break;
    case 3:
        riddle_io_print(f, "<path d=\"M%.2f %.2fl%.2f %.2fl%.2f %.2fl%.2f %.2fz\"/>\n", x, y - 1.3 * r, 1.3 * r,
                        1.3 * r, -1.3 * r, 1.3 * r, -1.3 * r, -1.3 * r);
        break;
    default: riddle_io_print(f, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\"/>\n", x, y, r);
    }
}

static inline void riddle_plot__draw_points(riddle_io_file *f, const riddle_plot__panel *a,
                                            const riddle_plot__series *s) {
    double r = s->n > 1500 ? 1.4 : s->n > 200 || s->flags & RIDDLE_PLOT_THIN ? 2.4 : 4.0;
    riddle_io_print(f, "<g fill=\"%s\" stroke=\"white\" stroke-width=\"%s\"%s>\n", riddle_plot__colour_of(s),
                    r > 3.0 ? "0.8" : "0", s->n > 200 || s->flags & RIDDLE_PLOT_FAINT ? " fill-opacity=\"0.55\"" : "");
    for (int i = 0; i < s->n; i++) {
        if (!riddle_plot__visible(a, s->x[i], s->y[i])) continue;
        double u = riddle_plot__share(&a->x, s->x[i]), v = riddle_plot__share(&a->y, s->y[i]);
        if (u < -1e-6 || u > 1.0 + 1e-6 || v < -1e-6 || v > 1.0 + 1e-6) continue;
        riddle_plot__draw_marker(f, s, riddle_plot__px(a, s->x[i]), riddle_plot__py(a, s->y[i]), r);
    }
    riddle_io_print(f, "</g>\n");
}

static inline double riddle_plot__floor_of(const riddle_plot__axis *a, double v) {
    return a->log && !(v > 0.0) ? a->low : v;
}

static inline void riddle_plot__draw_band(riddle_io_file *f, const riddle_plot__panel *a,
                                          const riddle_plot__series *s) {
    for (int i = 0; i < s->n;) {
        int end = i;
        while (end < s->n && riddle_plot__visible(a, s->x[end], s->z[end]) && s->y[end] - s->y[end] == 0.0) end++;
        if (end - i > 1) {
            riddle_io_print(f, "<path fill=\"%s\" fill-opacity=\"0.22\" d=\"", riddle_plot__colour_of(s));
            for (int k = i; k < end; k++)
                riddle_io_print(f, "%s%.2f %.2f", k == i ? "M" : "L", riddle_plot__limited(riddle_plot__px(a, s->x[k])),
                                riddle_plot__limited(riddle_plot__py(a, s->z[k])));
            for (int k = end - 1; k >= i; k--)
                riddle_io_print(f, "L%.2f %.2f", riddle_plot__limited(riddle_plot__px(a, s->x[k])),
                                riddle_plot__limited(riddle_plot__py(a, riddle_plot__floor_of(&a->y, s->y[k]))));
            riddle_io_print(f, "Z\"/>\n");
        }
        i = end > i ? end : i + 1;
    }
}

static inline bool riddle_plot__has_length(const riddle_plot__series *s, int i) {
    return s->z[i] >= 0.0 && s->z[i] < HUGE_VAL;
}

static inline void riddle_plot__draw_error_bars(riddle_io_file *f, const riddle_plot__panel *a,
                                                const riddle_plot__series *s) {
    riddle_io_print(f, "<g stroke=\"%s\" stroke-width=\"1.6\">\n", riddle_plot__colour_of(s));
    for (int i = 0; i < s->n; i++) {
        if (!riddle_plot__visible(a, s->x[i], s->y[i]) || !riddle_plot__has_length(s, i)) continue;
        double x = riddle_plot__limited(riddle_plot__px(a, s->x[i])),
               top = riddle_plot__limited(riddle_plot__py(a, s->y[i] + s->z[i])),
               base = riddle_plot__limited(riddle_plot__py(a, riddle_plot__floor_of(&a->y, s->y[i] - s->z[i])));
        riddle_io_print(f, "<path d=\"M%.2f %.2fh8m-4 0V%.2fm-4 0h8\"/>\n", x - 4.0, top, base);
    }
    riddle_io_print(f, "</g>\n");
    riddle_plot__draw_points(f, a, s);
}

static inline double riddle_plot__disc_radius(const riddle_plot__panel *a, const riddle_plot__series *s, int i) {
    double r = riddle_plot__px(a, s->x[i] + s->z[i]) - riddle_plot__px(a, s->x[i]);
    return r > 0.0 && r < 1e5 ? r : 0.0;
}

/* Draws discs lit from the upper left: a light spot over the colour, and a dark rim. */
static inline void riddle_plot__draw_discs(riddle_io_file *f, const riddle_plot__panel *a,
                                           const riddle_plot__series *s) {
    const char *colour = riddle_plot__colour_of(s);
    riddle_io_print(
        f,
        "<radialGradient id=\"ball%s\" cx=\"0.36\" cy=\"0.32\" r=\"0.75\"><stop offset=\"0\" stop-color=\"white\"/>"
        "<stop offset=\"0.35\" stop-color=\"%s\"/><stop offset=\"1\" stop-color=\"#222\"/></radialGradient>\n",
        colour + 1, colour);
    riddle_io_print(f, "<g fill=\"url(#ball%s)\">\n", colour + 1);
    for (int i = 0; i < s->n; i++) {
        if (!riddle_plot__visible(a, s->x[i], s->y[i])) continue;
        double r = riddle_plot__disc_radius(a, s, i);
        if (r > 0.0)
            riddle_io_print(f, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\"/>\n",
                            riddle_plot__limited(riddle_plot__px(a, s->x[i])),
                            riddle_plot__limited(riddle_plot__py(a, s->y[i])), r);
    }
    riddle_io_print(f, "</g>\n");
}

/* Finds the place of a bar series among these, and their number. */
static inline void riddle_plot__bar_place(const riddle_plot__panel *a, const riddle_plot__series *s, int *index,
                                          int *count) {
    *index = *count = 0;
    for (int i = 0; i < a->n; i++) {
        if (a->all[i].kind != RIDDLE_PLOT__BARS) continue;
        if (&a->all[i] == s) *index = *count;
        ++*count;
    }
}

static inline void riddle_plot__bar_edges(const riddle_plot__panel *a, const riddle_plot__series *s, int i,
                                          double *left, double *right) {
    int index, count;
    riddle_plot__bar_place(a, s, &index, &count);
    double width = 0.78 / count;
    *left = i - 0.39 + width * index;
    *right = *left + width * (count > 1 ? 0.94 : 1.0);
}

static inline void riddle_plot__draw_bars(riddle_io_file *f, const riddle_plot__panel *a,
                                          const riddle_plot__series *s) {
    for (int i = 0; i < s->n; i++) {
        double left, right, base = a->y.log ? a->y.low : fmax(0.0, a->y.low);
        if (!riddle_plot__can_show(&a->y, s->y[i])) continue;
        riddle_plot__bar_edges(a, s, i, &left, &right);
        double y0 = riddle_plot__limited(riddle_plot__py(a, base)),
               y1 = riddle_plot__limited(riddle_plot__py(a, s->y[i])), top = fmin(y0, y1);
        riddle_io_print(f, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"%s\"/>\n",
                        riddle_plot__px(a, left), top, riddle_plot__px(a, right) - riddle_plot__px(a, left),
                        fabs(y1 - y0), riddle_plot__colour_of(s));
    }
}

static inline void riddle_plot__heat_range(const riddle_plot__series *s, double *low, double *high) {
    if (s->z) {
        *low = s->z[0];
        *high = s->z[1];
        return;
    }
    static const riddle_plot__axis plain = {0.0, 1.0, false, false, NULL};
    *low = HUGE_VAL;
    *high = -HUGE_VAL;
    for (int i = 0; i < s->columns * s->rows; i++) riddle_plot__include(&plain, s->y[i], low, high);
    if (!(*low <= *high)) {
        *low = 0.0;
        *high = 1.0;
    }
    *low = fmin(fmax(*low, -1e300), 1e300); /* so that their difference is finite */
    *high = fmin(fmax(*high, -1e300), 1e300);
    if (!(*high > *low)) *high = *low + (*low != 0.0 ? fabs(*low) : 1.0);
}

static inline double riddle_plot__between(double from, double to, int i, int n) {
    return from * (1.0 - (double)i / n) + to * ((double)i / n);
}

/* Returns the level of a value in a heat map, 0 .. 160, or -1 where there is no number. */
static inline int riddle_plot__heat_level(double v, double low, double high) {
    return v - v == 0.0 ? (int)(160.0 * fmin(fmax((v - low) / (high - low), 0.0), 1.0)) : -1;
}

/* Neighbours of one colour in a row are one rectangle. */
static inline void riddle_plot__draw_heat(riddle_io_file *f, const riddle_plot__panel *a,
                                          const riddle_plot__series *s) {
    double low, high;
    if (s->n == 0 || !riddle_plot__visible(a, s->x[0], s->x[2]) || !riddle_plot__visible(a, s->x[1], s->x[3])) return;
    riddle_plot__heat_range(s, &low, &high);
    riddle_io_print(f, "<g shape-rendering=\"crispEdges\">\n");
    for (int row = 0; row < s->rows; row++) {
        double y0 = riddle_plot__between(s->x[2], s->x[3], row, s->rows),
               y1 = riddle_plot__between(s->x[2], s->x[3], row + 1, s->rows);
        double top = fmin(riddle_plot__py(a, y0), riddle_plot__py(a, y1)),
               height = fabs(riddle_plot__py(a, y1) - riddle_plot__py(a, y0));
        for (int i = 0, end; i < s->columns; i = end) {
            const double *values = s->y + (size_t)row * (size_t)s->columns;
            int level = riddle_plot__heat_level(values[i], low, high), rgb[3];
            for (end = i + 1; end < s->columns && riddle_plot__heat_level(values[end], low, high) == level;) end++;
            if (level < 0) continue;
            riddle_plot__heat_colour((level + 0.5) / 161.0, rgb);
            double x0 = riddle_plot__px(a, riddle_plot__between(s->x[0], s->x[1], i, s->columns)),
                   x1 = riddle_plot__px(a, riddle_plot__between(s->x[0], s->x[1], end, s->columns));
            riddle_io_print(f, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"#%02x%02x%02x\"/>\n",
                            fmin(x0, x1), top, fabs(x1 - x0) + 0.3, height + 0.3, (unsigned)rgb[0], (unsigned)rgb[1],
                            (unsigned)rgb[2]);
        }
    }
    riddle_io_print(f, "</g>\n");
}

static inline void riddle_plot__draw_colour_bar(riddle_io_file *f, const riddle_plot__panel *a,
                                                const riddle_plot__series *s) {
    double low, high;
    riddle_plot__heat_range(s, &low, &high);
    riddle_plot__axis scale = {low, high, false, false, NULL};
    riddle_plot__tick ticks[RIDDLE_PLOT__MOST_TICKS];
    int exponent, n = riddle_plot__make_ticks(&scale, 5, ticks, &exponent);
    double x = a->at.x + a->at.width + 16.0, y = a->at.y, height = a->at.height, widest = 0.0;
    const int parts = s->named ? s->named : 64;
    riddle_io_print(f, "<g shape-rendering=\"crispEdges\">\n");
    for (int i = 0; i < parts; i++) {
        int rgb[3];
        riddle_plot__heat_colour((i + 0.5) / parts, rgb);
        riddle_io_print(f, "<rect x=\"%.1f\" y=\"%.2f\" width=\"14\" height=\"%.2f\" fill=\"#%02x%02x%02x\"/>\n", x,
                        y + height * (parts - 1 - i) / parts, height / parts + 0.4, (unsigned)rgb[0], (unsigned)rgb[1],
                        (unsigned)rgb[2]);
    }
    riddle_io_print(f, "</g>\n");
    for (int i = 0; i < s->named; i++) {
        riddle_plot__text_at(f, x + 23.0, y + height * (s->named - i - 0.5) / s->named + 5.0, "start", "tick",
                             s->names[i]);
        widest = fmax(widest, riddle_plot__text_width(s->names[i], RIDDLE_PLOT__TICK_SIZE));
    }
    for (int i = 0; i < n && !s->named; i++) {
        if (!ticks[i].major) continue;
        double at = y + height * (1.0 - riddle_plot__share(&scale, ticks[i].at));
        riddle_io_print(
            f, "<path d=\"M%.1f %.1fh5\" stroke=\"#333\"/><text x=\"%.1f\" y=\"%.1f\" class=\"tick\">%s</text>\n",
            x + 14.0, at, x + 23.0, at + 5.0, ticks[i].text);
        widest = fmax(widest, 0.58 * RIDDLE_PLOT__TICK_SIZE * ticks[i].letters);
    }
    if (!s->named) riddle_plot__power_of_ten(f, x, y - 7.0, "start", exponent);
    if (s->label && *s->label) {
        double lx = x + 23.0 + widest + 16.0, ly = y + 0.5 * height;
        riddle_plot__upright_label(f, lx, ly, height + 24.0, s->label);
    }
}

static inline void riddle_plot__draw_reference(riddle_io_file *f, const riddle_plot__panel *a,
                                               const riddle_plot__series *s) {
    bool horizontal = s->kind == RIDDLE_PLOT__HORIZONTAL;
    double v = horizontal ? s->y[0] : s->x[0];
    const riddle_plot__axis *along = horizontal ? &a->y : &a->x;
    if (!riddle_plot__can_show(along, v) || riddle_plot__share(along, v) < 0.0 || riddle_plot__share(along, v) > 1.0)
        return;
    const char *dash = s->flags & RIDDLE_PLOT_DOTTED ? "2 4" : "6 4";
    if (horizontal) {
        double y = riddle_plot__py(a, v);
        riddle_io_print(f, "<path d=\"M%.1f %.2fh%.1f\" stroke=\"%s\" stroke-width=\"1.5\" stroke-dasharray=\"%s\"/>\n",
                        a->at.x, y, a->at.width, riddle_plot__colour_of(s), dash);
        riddle_plot__text_at(f, a->at.x + a->at.width - 6.0, y - 5.0, "end", "note", s->label);
    } else {
        double x = riddle_plot__px(a, v),
               width = s->label ? riddle_plot__text_width(s->label, RIDDLE_PLOT__TICK_SIZE) : 0.0;
        bool right = x + width + 8.0 < a->at.x + a->at.width;
        riddle_io_print(f, "<path d=\"M%.2f %.1fv%.1f\" stroke=\"%s\" stroke-width=\"1.5\" stroke-dasharray=\"%s\"/>\n",
                        x, a->at.y, a->at.height, riddle_plot__colour_of(s), dash);
        if (right || x - width - 8.0 > a->at.x)
            riddle_plot__text_at(f, right ? x + 5.0 : x - 5.0, a->at.y + 16.0, right ? "start" : "end", "note",
                                 s->label);
        else if (s->label) { /* along the line */
            riddle_io_print(f, "<text transform=\"translate(%.2f %.1f) rotate(90)\" class=\"note\">", x + 5.0,
                            a->at.y + 6.0);
            riddle_plot__escaped(f, s->label);
            riddle_io_print(f, "</text>\n");
        }
    }
}

/* Finds where a text in a panel begins. One that would leave the panel at the right is moved to the left. Returns 0 if
   its place is not visible. */
static inline int riddle_plot__text_place(const riddle_plot__panel *a, const riddle_plot__series *s, double *x,
                                          double *y) {
    if (s->kind == RIDDLE_PLOT__TEXT_SHARE) {
        *x = a->at.x + a->at.width * s->x[0];
        *y = a->at.y + a->at.height * (1.0 - s->y[0]);
    } else {
        if (!riddle_plot__visible(a, s->x[0], s->y[0])) return 0;
        *x = riddle_plot__limited(riddle_plot__px(a, s->x[0]));
        *y = riddle_plot__limited(riddle_plot__py(a, s->y[0]));
    }
    const double last =
        s->label ? a->at.x + a->at.width - RIDDLE_PLOT__PAD - riddle_plot__text_width(s->label, RIDDLE_PLOT__TICK_SIZE)
                 : *x;
    if (*x > last) *x = last > a->at.x + RIDDLE_PLOT__PAD ? last : a->at.x + RIDDLE_PLOT__PAD;
    return 1;
}

static inline void riddle_plot__draw_text(riddle_io_file *f, const riddle_plot__panel *a,
                                          const riddle_plot__series *s) {
    double x, y;
    if (riddle_plot__text_place(a, s, &x, &y)) riddle_plot__text_at(f, x, y, "start", "note", s->label);
}

static inline void riddle_plot__draw_series(riddle_io_file *f, const riddle_plot__panel *a,
                                            const riddle_plot__series *s) {
    if (s->n == 0 && s->kind != RIDDLE_PLOT__DISCS) return; /* the legend uses the gradient that discs define */
    switch (s->kind) {
    case RIDDLE_PLOT__LINE:
        if (!(s->flags & RIDDLE_PLOT_NO_LINE)) riddle_plot__draw_path(f, a, s);
        if (s->flags & RIDDLE_PLOT_MARKED) riddle_plot__draw_points(f, a, s);
        break;
    case RIDDLE_PLOT__POINTS: riddle_plot__draw_points(f, a, s); break;
    case RIDDLE_PLOT__BAND: riddle_plot__draw_band(f, a, s); break;
    case RIDDLE_PLOT__ERROR_BARS: riddle_plot__draw_error_bars(f, a, s); break;
    case RIDDLE_PLOT__DISCS: riddle_plot__draw_discs(f, a, s); break;
    case RIDDLE_PLOT__BARS: riddle_plot__draw_bars(f, a, s); break;
    case RIDDLE_PLOT__HEAT: riddle_plot__draw_heat(f, a, s); break;
    case RIDDLE_PLOT__HORIZONTAL:
    case RIDDLE_PLOT__VERTICAL: riddle_plot__draw_reference(f, a, s); break;
    case RIDDLE_PLOT__TEXT:
    case RIDDLE_PLOT__TEXT_SHARE: riddle_plot__draw_text(f, a, s); break;
    }
}

/* ---- layout ---- */

static inline double riddle_plot__entry_width(const riddle_plot__series *s) {
    return RIDDLE_PLOT__SWATCH + 3 * RIDDLE_PLOT__PAD + riddle_plot__text_width(s->label, RIDDLE_PLOT__TICK_SIZE);
}
static inline bool riddle_plot__in_legend(const riddle_plot__series *s) {
    return s->label && *s->label && (s->kind <= RIDDLE_PLOT__BARS);
}

static inline const riddle_plot__series *riddle_plot__first_of(const riddle_plot__panel *a,
                                                               riddle_plot__series_kind kind) {
    for (int i = 0; i < a->n; i++)
        if (a->all[i].kind == kind && a->all[i].n > 0) return &a->all[i];
    return NULL;
}

static inline void riddle_plot__find_ranges(riddle_plot__panel *a) {
    double x0 = HUGE_VAL, x1 = -HUGE_VAL, y0 = HUGE_VAL, y1 = -HUGE_VAL;
    bool tight = false;
    const riddle_plot__series *bars = riddle_plot__first_of(a, RIDDLE_PLOT__BARS);
    for (int k = 0; k < a->n; k++) {
        const riddle_plot__series *s = &a->all[k];
        if (s->n == 0 || s->kind == RIDDLE_PLOT__TEXT || s->kind == RIDDLE_PLOT__TEXT_SHARE) continue;
        if (s->kind == RIDDLE_PLOT__HEAT) {
            tight = true;
            for (int i = 0; i < 2; i++) {
                riddle_plot__include(&a->x, s->x[i], &x0, &x1);
                riddle_plot__include(&a->y, s->x[2 + i], &y0, &y1);
            }
            continue;
        }
        for (int i = 0; i < s->n; i++) {
            if (s->x && s->kind != RIDDLE_PLOT__HORIZONTAL &&
                (!s->y || s->kind == RIDDLE_PLOT__VERTICAL || riddle_plot__can_show(&a->y, s->y[i])))
                riddle_plot__include(&a->x, s->x[i], &x0, &x1);
            if (s->kind == RIDDLE_PLOT__VERTICAL ||
                (s->x && s->kind != RIDDLE_PLOT__HORIZONTAL && !riddle_plot__can_show(&a->x, s->x[i])))
                continue;
            if (a->x.fixed_range && s->x && s->kind != RIDDLE_PLOT__HORIZONTAL &&
                (s->x[i] < a->x.low || s->x[i] > a->x.high))
                continue;
            riddle_plot__include(&a->y, s->y[i], &y0, &y1);
            if (s->kind == RIDDLE_PLOT__BAND) riddle_plot__include(&a->y, s->z[i], &y0, &y1);
            for (int side = -1; side <= 1 && s->kind == RIDDLE_PLOT__DISCS && riddle_plot__has_length(s, i);
                 side += 2) {
                riddle_plot__include(&a->x, s->x[i] + side * s->z[i], &x0, &x1);
                riddle_plot__include(&a->y, s->y[i] + side * s->z[i], &y0, &y1);
            }
            if (s->kind == RIDDLE_PLOT__ERROR_BARS && riddle_plot__has_length(s, i)) {
                riddle_plot__include(&a->y, s->y[i] - s->z[i], &y0, &y1);
                riddle_plot__include(&a->y, s->y[i] + s->z[i], &y0, &y1);
            }
        }
    }
    if (bars) {
        a->x.log = false;
        if (!a->y.log) riddle_plot__include(&a->y, 0.0, &y0, &y1);
        riddle_plot__set_range(&a->x, -0.6, bars->n - 0.4);
    }
    riddle_plot__settle(&a->x, x0, x1, tight);
    riddle_plot__settle(&a->y, y0, y1, tight);
}

static inline void riddle_plot__keep_equal(riddle_plot__panel *a) {
    if (!a->equal || a->x.log || a->y.log) return;
    double x_unit = a->at.width / (a->x.high - a->x.low), y_unit = a->at.height / (a->y.high - a->y.low);
    riddle_plot__axis *wider = x_unit > y_unit ? &a->x : &a->y;
    double factor = x_unit > y_unit ? x_unit / y_unit : y_unit / x_unit, middle = 0.5 * (wider->low + wider->high);
    double half = 0.5 * factor * (wider->high - wider->low);
    if (!(half < 1e300)) return;
    wider->low = middle - half;
    wider->high = middle + half;
}

static inline int riddle_plot__ticks_along(double length, double spacing) {
    int n = (int)(length / spacing);
    return n < 2 ? 2 : n > 9 ? 9 : n;
}

static inline bool riddle_plot__slanted_names(const riddle_plot__panel *a, const riddle_plot__series *bars) {
    for (int i = 0; i < bars->n; i++)
        if (bars->names && bars->names[i] &&
            riddle_plot__text_width(bars->names[i], RIDDLE_PLOT__TICK_SIZE) > 0.95 * a->at.width / bars->n)
            return true;
    return false;
}

/* Where the data are, on a coarse raster of the panel, so that the legend can stand where they are not. */
#define RIDDLE_PLOT__RASTER_X 72
#define RIDDLE_PLOT__RASTER_Y 48
typedef bool riddle_plot__raster[RIDDLE_PLOT__RASTER_Y][RIDDLE_PLOT__RASTER_X];

static inline void riddle_plot__stain(riddle_plot__raster r, const riddle_plot__panel *a, double x, double y,
                                      double reach) {
    double u = (x - a->at.x) / a->at.width, v = (y - a->at.y) / a->at.height;
    int i0 = (int)floor((u - reach / a->at.width) * RIDDLE_PLOT__RASTER_X),
        i1 = (int)floor((u + reach / a->at.width) * RIDDLE_PLOT__RASTER_X);
    int j0 = (int)floor((v - reach / a->at.height) * RIDDLE_PLOT__RASTER_Y),
        j1 = (int)floor((v + reach / a->at.height) * RIDDLE_PLOT__RASTER_Y);
    for (int j = j0 < 0 ? 0 : j0; j <= j1 && j < RIDDLE_PLOT__RASTER_Y; j++)
        for (int i = i0 < 0 ? 0 : i0; i <= i1 && i < RIDDLE_PLOT__RASTER_X; i++) r[j][i] = true;
}

static inline void riddle_plot__stain_segment(riddle_plot__raster r, const riddle_plot__panel *a, double x0, double y0,
                                              double x1, double y1) {
    double longest =
        fmax(fabs(x1 - x0) / a->at.width * RIDDLE_PLOT__RASTER_X, fabs(y1 - y0) / a->at.height * RIDDLE_PLOT__RASTER_Y);
    int steps = 1 + (int)fmin(2.0 * longest, 2000.0);
    for (int k = 0; k <= steps; k++)
        riddle_plot__stain(r, a, x0 + (x1 - x0) * k / steps, y0 + (y1 - y0) * k / steps, 3.0);
}

static inline void riddle_plot__stain_series(riddle_plot__raster r, const riddle_plot__panel *a,
                                             const riddle_plot__series *s) {
    if (s->kind == RIDDLE_PLOT__HEAT) {
        memset(r, 1, sizeof(riddle_plot__raster));
        return;
    }
    for (int i = 0; i < s->n; i++) {
        if (s->kind == RIDDLE_PLOT__DISCS) {
            if (riddle_plot__visible(a, s->x[i], s->y[i]))
                riddle_plot__stain(r, a, riddle_plot__limited(riddle_plot__px(a, s->x[i])),
                                   riddle_plot__limited(riddle_plot__py(a, s->y[i])),
                                   riddle_plot__disc_radius(a, s, i));
        } else if (s->kind == RIDDLE_PLOT__BARS) {
            double left, right;
            if (!riddle_plot__can_show(&a->y, s->y[i])) continue;
            riddle_plot__bar_edges(a, s, i, &left, &right);
            double base = a->y.log ? a->y.low : fmax(0.0, a->y.low);
            for (int k = 0; k <= 8; k++) {
                double x = riddle_plot__px(a, left + (right - left) * k / 8.0);
                riddle_plot__stain_segment(r, a, x, riddle_plot__limited(riddle_plot__py(a, base)), x,
                                           riddle_plot__limited(riddle_plot__py(a, s->y[i])));
            }
        } else if (s->kind == RIDDLE_PLOT__HORIZONTAL && riddle_plot__can_show(&a->y, s->y[i])) {
            double y = riddle_plot__limited(riddle_plot__py(a, s->y[i])), end = a->at.x + a->at.width;
            riddle_plot__stain_segment(r, a, a->at.x, y, end, y);
            if (s->label)
                for (int k = 0; k < 3; k++)
                    riddle_plot__stain_segment(r, a,
                                               end - riddle_plot__text_width(s->label, RIDDLE_PLOT__TICK_SIZE) - 6.0,
                                               y - 7.0 * k, end, y - 7.0 * k);
        } else if (s->kind == RIDDLE_PLOT__VERTICAL && riddle_plot__can_show(&a->x, s->x[i])) {
            double x = riddle_plot__limited(riddle_plot__px(a, s->x[i]));
            riddle_plot__stain_segment(r, a, x, a->at.y, x, a->at.y + a->at.height);
            if (s->label && *s->label) {
                double width = riddle_plot__text_width(s->label, RIDDLE_PLOT__TICK_SIZE) + 10.0,
                       start = x + width < a->at.x + a->at.width ? x : x - width;
                for (int k = 0; k < 3; k++)
                    riddle_plot__stain_segment(r, a, start, a->at.y + 7.0 * k, start + width, a->at.y + 7.0 * k);
            }
        } else if (s->kind == RIDDLE_PLOT__TEXT || s->kind == RIDDLE_PLOT__TEXT_SHARE) {
            double x, y;
            for (int k = 0; k < 3 && s->label && riddle_plot__text_place(a, s, &x, &y); k++)
                riddle_plot__stain_segment(r, a, x, y - 6.0 * k,
                                           x + riddle_plot__text_width(s->label, RIDDLE_PLOT__TICK_SIZE), y - 6.0 * k);
        } else if (s->kind <= RIDDLE_PLOT__ERROR_BARS && riddle_plot__visible(a, s->x[i], s->y[i])) {
            double x = riddle_plot__limited(riddle_plot__px(a, s->x[i])),
                   y = riddle_plot__limited(riddle_plot__py(a, s->y[i]));
            riddle_plot__stain(r, a, x, y,
                               s->kind == RIDDLE_PLOT__LINE && !(s->flags & RIDDLE_PLOT_MARKED) ? 3.0 : 6.0);
            if (s->kind == RIDDLE_PLOT__ERROR_BARS && riddle_plot__has_length(s, i))
                riddle_plot__stain_segment(
                    r, a, x, riddle_plot__limited(riddle_plot__py(a, s->y[i] + s->z[i])), x,
                    riddle_plot__limited(riddle_plot__py(a, riddle_plot__floor_of(&a->y, s->y[i] - s->z[i]))));
            if (s->kind == RIDDLE_PLOT__BAND && riddle_plot__can_show(&a->y, s->z[i]))
                riddle_plot__stain_segment(r, a, x, y, x, riddle_plot__limited(riddle_plot__py(a, s->z[i])));
            bool joined = s->kind == RIDDLE_PLOT__LINE || s->kind == RIDDLE_PLOT__BAND;
            if (joined && i + 1 < s->n && riddle_plot__visible(a, s->x[i + 1], s->y[i + 1])) {
                riddle_plot__stain_segment(r, a, x, y, riddle_plot__limited(riddle_plot__px(a, s->x[i + 1])),
                                           riddle_plot__limited(riddle_plot__py(a, s->y[i + 1])));
                if (s->kind == RIDDLE_PLOT__BAND && riddle_plot__visible(a, s->x[i + 1], s->z[i + 1]) &&
                    riddle_plot__can_show(&a->y, s->z[i]))
                    riddle_plot__stain_segment(r, a, x, riddle_plot__limited(riddle_plot__py(a, s->z[i])),
                                               riddle_plot__limited(riddle_plot__px(a, s->x[i + 1])),
                                               riddle_plot__limited(riddle_plot__py(a, s->z[i + 1])));
            }
        }
    }
}

/* Finds a free place inside for the legend, nearest to a corner, the right ones first. */
static inline bool riddle_plot__place_inside(riddle_plot__panel *a) {
    riddle_plot__raster r;
    memset(r, 0, sizeof r);
    for (int k = 0; k < a->n; k++) riddle_plot__stain_series(r, a, &a->all[k]);
    int w = (int)ceil(a->at.legend_width / a->at.width * RIDDLE_PLOT__RASTER_X) + 1,
        h = (int)ceil(a->at.legend_height / a->at.height * RIDDLE_PLOT__RASTER_Y) + 1;
    double best = HUGE_VAL;
    for (int j = 1; j + h < RIDDLE_PLOT__RASTER_Y; j++)
        for (int i = 1; i + w < RIDDLE_PLOT__RASTER_X; i++) {
            bool free_place = true;
            for (int jj = j; jj < j + h && free_place; jj++)
                for (int ii = i; ii < i + w && free_place; ii++) free_place = !r[jj][ii];
            if (!free_place) continue;
            int from_right = RIDDLE_PLOT__RASTER_X - 1 - (i + w), from_bottom = RIDDLE_PLOT__RASTER_Y - 1 - (j + h);
            double aside = from_right <= i - 1 ? from_right : i - 1 + 0.4,
                   up = j - 1 <= from_bottom ? j - 1 : from_bottom + 0.8;
            if (aside * aside + up * up < best) {
                best = aside * aside + up * up;
                a->at.legend_x = a->at.x + a->at.width * i / RIDDLE_PLOT__RASTER_X;
                a->at.legend_y = a->at.y + a->at.height * j / RIDDLE_PLOT__RASTER_Y;
            }
        }
    return best < HUGE_VAL;
}

/* Lays out a panel, except for its place in the figure: it starts at 0, 0. */
static inline void riddle_plot__lay_out(const riddle_plot *p, riddle_plot__panel *a) {
    riddle_plot__tick ticks[RIDDLE_PLOT__MOST_TICKS];
    int exponent, n, entries = 0;
    a->at.width = p->width;
    a->at.height = p->height;
    a->at.x = a->at.y = 0.0;
    riddle_plot__find_ranges(a);
    riddle_plot__keep_equal(a);
    double widest = 0.0;
    n = riddle_plot__make_ticks(&a->y, riddle_plot__ticks_along(a->at.height, 48.0), ticks, &exponent);
    for (int i = 0; i < n; i++)
        if (ticks[i].major) widest = fmax(widest, 0.58 * RIDDLE_PLOT__TICK_SIZE * ticks[i].letters);
    a->at.left = 14.0 + widest + (a->y.label ? RIDDLE_PLOT__LABEL_SIZE + 12.0 : 0.0);
    a->at.top = (a->title ? RIDDLE_PLOT__TITLE_SIZE + 12.0 : 8.0) + (exponent ? 14.0 : 0.0);
    a->at.bottom = 28.0 + (a->x.label ? RIDDLE_PLOT__LABEL_SIZE + 12.0 : 0.0);
    a->at.right = 20.0;
    if (a->unit) {
        a->at.left = a->at.right = 8.0;
        a->at.top -= exponent ? 14.0 : 0.0;
        a->at.bottom = 34.0;
    }
    const riddle_plot__series *bars = riddle_plot__first_of(a, RIDDLE_PLOT__BARS),
                              *heat = riddle_plot__first_of(a, RIDDLE_PLOT__HEAT);
    if (bars && riddle_plot__slanted_names(a, bars)) {
        double longest = 0.0;
        for (int i = 0; i < bars->n; i++)
            if (bars->names && bars->names[i])
                longest = fmax(longest, riddle_plot__text_width(bars->names[i], RIDDLE_PLOT__TICK_SIZE));
        a->at.bottom += 0.55 * longest;
        a->at.left = fmax(a->at.left, 0.84 * longest - 0.5 * a->at.width / bars->n + 10.0);
    }
    if (heat) {
        double low, high, digits = 0.0;
        riddle_plot__heat_range(heat, &low, &high);
        riddle_plot__axis scale = {low, high, false, false, NULL};
        n = riddle_plot__make_ticks(&scale, 5, ticks, &exponent);
        for (int i = 0; i < n; i++)
            if (ticks[i].major) digits = fmax(digits, 0.58 * RIDDLE_PLOT__TICK_SIZE * ticks[i].letters);
        for (int i = 0; i < heat->named; i++)
            digits = fmax(digits, riddle_plot__text_width(heat->names[i], RIDDLE_PLOT__TICK_SIZE));
        a->at.right += 16.0 + 23.0 + digits + (heat->label && *heat->label ? 26.0 : 0.0);
    }
    double in_a_row = 0.0;
    a->at.legend_width = 0.0;
    for (int k = 0; k < a->n; k++)
        if (riddle_plot__in_legend(&a->all[k])) {
            entries++;
            a->at.legend_width = fmax(a->at.legend_width, riddle_plot__entry_width(&a->all[k]));
            in_a_row += riddle_plot__entry_width(&a->all[k]);
        }
    a->at.legend_height = entries * RIDDLE_PLOT__LEGEND_ROW + RIDDLE_PLOT__PAD;
    if (!entries || (!a->legend_outside && riddle_plot__place_inside(a))) return;
    /* The left end may hold the axis' exponent. */
    a->legend_above = !a->legend_outside && in_a_row < a->at.width - 30.0;
    if (a->legend_above) {
        a->at.legend_x = a->at.width - in_a_row;
        a->at.legend_y = -RIDDLE_PLOT__LEGEND_ROW - RIDDLE_PLOT__PAD / 2.0;
        a->at.top = (a->title ? RIDDLE_PLOT__TITLE_SIZE + 8.0 : 0.0) + RIDDLE_PLOT__LEGEND_ROW + RIDDLE_PLOT__PAD;
    } else {
        a->legend_outside = true;
        a->at.legend_x = a->at.width + a->at.right - 6.0;
        a->at.legend_y = 0.0;
        a->at.right += a->at.legend_width + 4.0;
        a->at.bottom = fmax(a->at.bottom, a->at.legend_height - a->at.height + 8.0);
    }
}

static inline void riddle_plot__draw_axes(riddle_io_file *f, const riddle_plot__panel *a) {
    riddle_plot__tick ticks[RIDDLE_PLOT__MOST_TICKS];
    const riddle_plot__layout *at = &a->at;
    const riddle_plot__series *bars = riddle_plot__first_of(a, RIDDLE_PLOT__BARS);
    int exponent, n;
    riddle_io_print(f, "<g class=\"grid\">\n");
    if (!bars) {
        n = riddle_plot__make_ticks(&a->x, riddle_plot__ticks_along(at->width, 78.0), ticks, &exponent);
        for (int i = 0; i < n; i++)
            riddle_io_print(f, "<path%s d=\"M%.2f %.1fv%.1f\"/>\n", ticks[i].major ? "" : " class=\"minor\"",
                            riddle_plot__px(a, ticks[i].at), at->y, at->height);
    }
    n = riddle_plot__make_ticks(&a->y, riddle_plot__ticks_along(at->height, 48.0), ticks, &exponent);
    for (int i = 0; i < n; i++)
        riddle_io_print(f, "<path%s d=\"M%.1f %.2fh%.1f\"/>\n", ticks[i].major ? "" : " class=\"minor\"", at->x,
                        riddle_plot__py(a, ticks[i].at), at->width);
    riddle_io_print(f, "</g>\n");
}

/* Draws the names of the groups below the frame. Returns the room that slanted ones take. */
static inline double riddle_plot__draw_names(riddle_io_file *f, const riddle_plot__panel *a,
                                             const riddle_plot__series *bars) {
    bool slanted = riddle_plot__slanted_names(a, bars);
    double room = 0.0, base = a->at.y + a->at.height;
    for (int i = 0; i < bars->n && bars->names; i++) {
        const char *name = bars->names[i] ? bars->names[i] : "";
        if (slanted) room = fmax(room, 0.55 * riddle_plot__text_width(name, RIDDLE_PLOT__TICK_SIZE));
        riddle_io_print(f, "<text class=\"tick\" text-anchor=\"%s\" transform=\"translate(%.1f %.1f)%s\">",
                        slanted ? "end" : "middle", riddle_plot__px(a, (double)i) + (slanted ? 5.0 : 0.0),
                        base + (slanted ? 14.0 : 20.0), slanted ? " rotate(-33)" : "");
        riddle_plot__escaped(f, name);
        riddle_io_print(f, "</text>\n");
    }
    return room;
}

static inline void riddle_plot__draw_x_numbers(riddle_io_file *f, const riddle_plot__panel *a) {
    riddle_plot__tick ticks[RIDDLE_PLOT__MOST_TICKS];
    int exponent, n = riddle_plot__make_ticks(&a->x, riddle_plot__ticks_along(a->at.width, 78.0), ticks, &exponent);
    double free_from = -HUGE_VAL, base = a->at.y + a->at.height;
    for (int i = 0; i < n; i++) {
        double x = riddle_plot__px(a, ticks[i].at), half = 0.29 * RIDDLE_PLOT__TICK_SIZE * ticks[i].letters;
        if (!ticks[i].major || x - half < free_from) continue;
        free_from = x + half + 5.0;
        riddle_io_print(f,
                        "<path class=\"mark\" d=\"M%.2f %.1fv5\"/><text x=\"%.2f\" y=\"%.1f\" text-anchor=\"middle\" "
                        "class=\"tick\">%s</text>\n",
                        x, base, x, base + 21.0, ticks[i].text);
    }
    riddle_plot__power_of_ten(f, a->at.x + a->at.width + 14.0, base + 40.0, "end", exponent);
}

/* Returns the exponent that stands above the axis. */
static inline int riddle_plot__draw_y_numbers(riddle_io_file *f, const riddle_plot__panel *a) {
    riddle_plot__tick ticks[RIDDLE_PLOT__MOST_TICKS];
    int exponent, n = riddle_plot__make_ticks(&a->y, riddle_plot__ticks_along(a->at.height, 48.0), ticks, &exponent);
    double widest = 0.0, free_below = HUGE_VAL;
    for (int i = 0; i < n; i++) {
        double y = riddle_plot__py(a, ticks[i].at);
        if (!ticks[i].major || y > free_below) continue;
        free_below = y - RIDDLE_PLOT__TICK_SIZE - 1.0;
        widest = fmax(widest, 0.58 * RIDDLE_PLOT__TICK_SIZE * ticks[i].letters);
        riddle_io_print(f,
                        "<path class=\"mark\" d=\"M%.1f %.2fh-5\"/><text x=\"%.1f\" y=\"%.2f\" text-anchor=\"end\" "
                        "class=\"tick\">%s</text>\n",
                        a->at.x, y, a->at.x - 9.0, y + 5.0, ticks[i].text);
    }
    riddle_plot__power_of_ten(f, a->at.x - 8.0, a->at.y - 7.0, "start", exponent);
    if (a->y.label && *a->y.label)
        riddle_plot__upright_label(f, a->at.x - 14.0 - widest - 8.0, a->at.y + 0.5 * a->at.height, a->at.height + 24.0,
                                   a->y.label);
    return exponent;
}

static inline void riddle_plot__draw_frame(riddle_io_file *f, const riddle_plot__panel *a) {
    const riddle_plot__layout *at = &a->at;
    const riddle_plot__series *bars = riddle_plot__first_of(a, RIDDLE_PLOT__BARS);
    double names = 0.0, above = 10.0;
    riddle_io_print(f, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" class=\"frame\"/>\n", at->x, at->y,
                    at->width, at->height);
    if (bars) names = riddle_plot__draw_names(f, a, bars);
    else riddle_plot__draw_x_numbers(f, a);
    int exponent = riddle_plot__draw_y_numbers(f, a);
    riddle_plot__text_at(f, at->x + 0.5 * at->width, at->y + at->height + 28.0 + RIDDLE_PLOT__LABEL_SIZE + names,
                         "middle", "label", a->x.label);
    if (a->legend_above) above += RIDDLE_PLOT__LEGEND_ROW;
    else if (exponent) above += 14.0;
    riddle_plot__text_at(f, at->x, at->y - above, "start", "title", a->title);
}

RIDDLE_PLOT_API double riddle_plot_round_length(double most) {
    const double power = pow(10.0, floor(log10(most)));
    return power * (most >= 5.0 * power ? 5.0 : most >= 2.0 * power ? 2.0 : 1.0);
}

/* Draws a bar of a round length, at most a quarter of the panel, below its lower left corner. */
static inline void riddle_plot__draw_scale_bar(riddle_io_file *f, const riddle_plot__panel *a) {
    const double unit = a->at.width / (a->x.high - a->x.low), y = a->at.y + a->at.height + 26.0,
                 length = riddle_plot_round_length(0.25 * (a->x.high - a->x.low));
    char text[60];
    if (!(length > 0.0 && length < 1e300)) return;
    snprintf(text, sizeof text, "%.6g %.30s", length, a->unit);
    riddle_io__use_point(text);
    riddle_io_print(f, "<path class=\"bar\" d=\"M%.1f %.1fv8m0 -4h%.2fm0 -4v8\"/>\n", a->at.x, y - 4.0, length * unit);
    riddle_plot__text_at(f, a->at.x + 0.5 * length * unit, y - 7.0, "middle", "tick", text);
}

static inline void riddle_plot__draw_legend(riddle_io_file *f, const riddle_plot__panel *a) {
    const riddle_plot__layout *at = &a->at;
    double x = at->legend_x + RIDDLE_PLOT__PAD, y = at->legend_y + RIDDLE_PLOT__PAD / 2.0;
    int entries = 0;
    for (int k = 0; k < a->n; k++) entries += riddle_plot__in_legend(&a->all[k]);
    if (!entries) return;
    if (!a->legend_outside && !a->legend_above)
        riddle_io_print(f,
                        "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" rx=\"4\" fill=\"white\" "
                        "fill-opacity=\"0.85\"/>\n",
                        at->legend_x, at->legend_y, at->legend_width, at->legend_height);
    for (int k = 0; k < a->n; k++) {
        const riddle_plot__series *s = &a->all[k];
        if (!riddle_plot__in_legend(s)) continue;
        double middle = y + RIDDLE_PLOT__LEGEND_ROW / 2.0;
        if (s->kind == RIDDLE_PLOT__LINE && !(s->flags & RIDDLE_PLOT_NO_LINE))
            riddle_io_print(
                f, "<path d=\"M%.1f %.1fh%.0f\" stroke=\"%s\" stroke-width=\"%s\" stroke-linecap=\"round\"%s%s/>\n", x,
                middle, RIDDLE_PLOT__SWATCH, riddle_plot__colour_of(s), s->flags & RIDDLE_PLOT_THIN ? "1.1" : "2.4",
                riddle_plot__dash_of(s), s->flags & RIDDLE_PLOT_FAINT ? " stroke-opacity=\"0.35\"" : "");
        if (s->kind == RIDDLE_PLOT__POINTS || s->kind == RIDDLE_PLOT__ERROR_BARS ||
            (s->kind == RIDDLE_PLOT__LINE && s->flags & RIDDLE_PLOT_MARKED)) {
            riddle_io_print(f, "<g fill=\"%s\">", riddle_plot__colour_of(s));
            riddle_plot__draw_marker(f, s, x + RIDDLE_PLOT__SWATCH / 2.0, middle, 4.0);
            riddle_io_print(f, "</g>");
        }
        if (s->kind == RIDDLE_PLOT__DISCS)
            riddle_io_print(f, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"8\" fill=\"url(#ball%s)\"/>\n",
                            x + RIDDLE_PLOT__SWATCH / 2.0, middle, riddle_plot__colour_of(s) + 1);
        if (s->kind == RIDDLE_PLOT__BAND || s->kind == RIDDLE_PLOT__BARS)
            riddle_io_print(f, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.0f\" height=\"12\" fill=\"%s\"%s/>\n", x,
                            middle - 6.0, RIDDLE_PLOT__SWATCH, riddle_plot__colour_of(s),
                            s->kind == RIDDLE_PLOT__BAND ? " fill-opacity=\"0.22\"" : "");
        riddle_plot__text_at(f, x + RIDDLE_PLOT__SWATCH + RIDDLE_PLOT__PAD, middle + 5.0, "start", "note", s->label);
        if (a->legend_above) x += riddle_plot__entry_width(s);
        else y += RIDDLE_PLOT__LEGEND_ROW;
    }
}

static inline void riddle_plot__draw_panel(riddle_io_file *f, const riddle_plot__panel *a, int number) {
    const riddle_plot__series *heat = riddle_plot__first_of(a, RIDDLE_PLOT__HEAT);
    riddle_io_print(f, "<clipPath id=\"c%d\"><rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/></clipPath>\n",
                    number, a->at.x, a->at.y, a->at.width, a->at.height);
    if (!heat && !a->unit) riddle_plot__draw_axes(f, a);
    /* markers on the edge are drawn whole, what can leave the panel is cut */
    riddle_io_print(f, "<g clip-path=\"url(#c%d)\">\n", number);
    for (int k = 0; k < a->n; k++)
        if (a->all[k].kind != RIDDLE_PLOT__POINTS && a->all[k].kind < RIDDLE_PLOT__TEXT)
            riddle_plot__draw_series(f, a, &a->all[k]);
    riddle_io_print(f, "</g>\n");
    if (!a->unit) riddle_plot__draw_frame(f, a);
    else riddle_plot__text_at(f, a->at.x, a->at.y - (a->legend_above ? 31.0 : 10.0), "start", "title", a->title);
    if (a->unit) riddle_plot__draw_scale_bar(f, a);
    for (int k = 0; k < a->n; k++)
        if (a->all[k].kind == RIDDLE_PLOT__POINTS || a->all[k].kind >= RIDDLE_PLOT__TEXT)
            riddle_plot__draw_series(f, a, &a->all[k]);
    if (heat) riddle_plot__draw_colour_bar(f, a, heat);
    riddle_plot__draw_legend(f, a);
}

static inline const char *riddle_plot__style(void) {
    return "<style>text{font-family:Inter,'Helvetica Neue',Helvetica,Arial,'Liberation Sans','DejaVu "
           "Sans',sans-serif;fill:#222}"
           ".tick{font-size:14px;fill:#333}.label{font-size:15px}.title{font-size:16px;font-weight:600}.head{font-"
           "weight:600}"
           /* Legible on bars. */
           ".note{font-size:14px;paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}"
           ".up{font-size:10px}.grid path{stroke:#dcdcdc;stroke-width:1}"
           ".grid .minor{stroke:#f1f1f1}.frame{fill:none;stroke:#444;stroke-width:1.2}"
           ".mark{stroke:#444;stroke-width:1.2}.bar{fill:none;stroke:#222;stroke-width:1.8}</style>\n";
}

/* Gives every panel its place. Panels of a column are below each other, those of a row beside each other. */
static inline void riddle_plot__place_panels(riddle_plot *p, double head, double *width, double *height) {
    double column_left[6] = {0}, column_right[6] = {0}, row_top[6] = {0}, row_bottom[6] = {0};
    for (int i = 0; i < p->rows * p->columns; i++) {
        riddle_plot__panel *a = &p->panels[i];
        int r = i / p->columns, c = i % p->columns;
        if (!a->used) continue;
        riddle_plot__lay_out(p, a);
        column_left[c] = fmax(column_left[c], a->at.left);
        column_right[c] = fmax(column_right[c], a->at.right);
        row_top[r] = fmax(row_top[r], a->at.top);
        row_bottom[r] = fmax(row_bottom[r], a->at.bottom);
    }
    *height = head;
    for (int r = 0; r < p->rows; r++) {
        *width = 4.0;
        for (int c = 0; c < p->columns; c++) {
            riddle_plot__panel *a = &p->panels[r * p->columns + c];
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

RIDDLE_PLOT_API riddle_io_status riddle_plot_write(riddle_plot *p, const char *folder, const char *name) {
    if (!p) return RIDDLE_IO_BAD_ARGUMENT;
    if (p->failed) {
        riddle_plot_free(p);
        return riddle_io__no_memory(name);
    }
    double width = 0.0, height = 0.0;
    riddle_plot__place_panels(p, p->title && *p->title ? 38.0 : 4.0, &width, &height);
    /* a title that is too long for the figure gets smaller letters; bold ones are a quarter wider */
    double title_size = 19.0,
           title_width = p->title ? 1.25 * riddle_plot__text_width(p->title, title_size) + 30.0 : 0.0;
    if (title_width > width) title_size = fmax(13.0, title_size * width / title_width);
    width = fmax(width, title_width * title_size / 19.0);
    riddle_io_file *f = riddle_io_open(folder, name);
    if (!f) {
        riddle_plot_free(p);
        return RIDDLE_IO_NOT_WRITTEN;
    }
    riddle_io_print(
        f, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\">\n",
        width, height, width, height);
    riddle_io_print(f, "%s<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n", riddle_plot__style());
    if (p->title) {
        riddle_io_print(f, "<text x=\"16\" y=\"27\" class=\"head\" font-size=\"%.1f\">", title_size);
        riddle_plot__escaped(f, p->title);
        riddle_io_print(f, "</text>\n");
    }
    for (int i = 0; i < p->rows * p->columns; i++)
        if (p->panels[i].used) riddle_plot__draw_panel(f, &p->panels[i], i);
    riddle_io_print(f, "</svg>\n");
    riddle_plot_free(p);
    return riddle_io_close(f);
}

#endif /* RIDDLE_PLOT__BODIES */

#ifdef __cplusplus
}
#endif
#endif
