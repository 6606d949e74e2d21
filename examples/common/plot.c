#define _POSIX_C_SOURCE 200809L
#include "plot.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"

/* ---- what a figure holds ---- */

typedef enum { LINE, POINTS, BAND, ERROR_BARS, BARS, HEAT, HORIZONTAL, VERTICAL, TEXT, TEXT_SHARE } series_kind;

typedef struct {
    series_kind kind;
    char *label;
    double *x, *y, *z; /* z: upper edge of a band, half-length of an error bar, the two ends of a heat map's colours */
    int n;
    char **names;      /* of the groups of bars */
    int columns, rows; /* of a heat map in y, its corners in x[4] */
    int colour, flags;
} series;

typedef struct {
    double low, high;
    bool log, fixed_range;
    char *label;
} axis;

typedef struct {
    double x, y, width, height;      /* the data area in the figure */
    double left, right, top, bottom; /* room for what stands around it */
    double legend_x, legend_y, legend_width, legend_height;
} layout;

typedef struct {
    bool used, equal, legend_outside, legend_above;
    char *title;
    axis x, y;
    series *all;
    int n, capacity, next_colour;
    layout at;
} panel;

struct plot {
    char *title;
    int rows, columns, current;
    double width, height;
    panel *panels;
    bool failed; /* out of memory */
};

/* Okabe & Ito (2008), colour-blind safe; their yellow is too pale for a line, a brown stands for it. */
static const char *const palette[8] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7A5C2E", "#555555"};

enum { TICK_SIZE = 14, LABEL_SIZE = 15, TITLE_SIZE = 16, LEGEND_ROW = 21, SWATCH = 30, PAD = 8 };

/* ---- building ---- */

static char *copy_text(plot *p, const char *text) {
    if (!text) return NULL;
    size_t size = strlen(text) + 1;
    char *c = malloc(size);
    if (c) memcpy(c, text, size);
    else p->failed = true;
    return c;
}

static double *copy_numbers(plot *p, const double *values, int n) {
    if (!values || n <= 0) return NULL;
    double *c = malloc((size_t)n * sizeof *c);
    if (c) memcpy(c, values, (size_t)n * sizeof *c);
    else p->failed = true;
    return c;
}

plot *plot_new(const char *title, int rows, int columns) {
    plot *p = calloc(1, sizeof *p);
    if (!p) {
        common_fail("out of memory for a figure");
        return NULL;
    }
    p->rows = rows < 1 ? 1 : rows > 6 ? 6 : rows;
    p->columns = columns < 1 ? 1 : columns > 6 ? 6 : columns;
    p->panels = calloc((size_t)(p->rows * p->columns), sizeof *p->panels);
    if (!p->panels) {
        free(p);
        common_fail("out of memory for a figure");
        return NULL;
    }
    p->title = copy_text(p, title);
    int most = p->rows > p->columns ? p->rows : p->columns;
    p->width = most == 1 ? 540.0 : most == 2 ? 430.0 : 340.0;
    p->height = most == 1 ? 360.0 : most == 2 ? 300.0 : 245.0;
    return p;
}

void plot_panel_size(plot *p, double width, double height) {
    if (!p) return;
    if (width >= 80.0 && width <= 4000.0) p->width = width;
    if (height >= 60.0 && height <= 4000.0) p->height = height;
}

static void free_series(series *s) {
    free(s->label);
    free(s->x);
    free(s->y);
    free(s->z);
    for (int i = 0; s->names && i < s->n; i++) free(s->names[i]);
    free(s->names);
}

void plot_free(plot *p) {
    if (!p) return;
    for (int i = 0; i < p->rows * p->columns; i++) {
        panel *a = &p->panels[i];
        for (int k = 0; k < a->n; k++) free_series(&a->all[k]);
        free(a->all);
        free(a->title);
        free(a->x.label);
        free(a->y.label);
    }
    free(p->panels);
    free(p->title);
    free(p);
}

static panel *current(plot *p) {
    if (!p) return NULL;
    p->panels[p->current].used = true;
    return &p->panels[p->current];
}

void plot_panel(plot *p, int row, int column, const char *x_label, const char *y_label) {
    if (!p || row < 0 || row >= p->rows || column < 0 || column >= p->columns) return;
    p->current = row * p->columns + column;
    panel *a = current(p);
    free(a->x.label);
    free(a->y.label);
    a->x.label = copy_text(p, x_label);
    a->y.label = copy_text(p, y_label);
}

void plot_title(plot *p, const char *title) {
    panel *a = current(p);
    if (!a) return;
    free(a->title);
    a->title = copy_text(p, title);
}

void plot_log_x(plot *p) {
    panel *a = current(p);
    if (a) a->x.log = true;
}

void plot_log_y(plot *p) {
    panel *a = current(p);
    if (a) a->y.log = true;
}

static void set_range(axis *a, double low, double high) {
    if (!(low < high) || !(high - low < HUGE_VAL)) return;
    a->low = low;
    a->high = high;
    a->fixed_range = true;
}

void plot_range_x(plot *p, double low, double high) {
    panel *a = current(p);
    if (a) set_range(&a->x, low, high);
}

void plot_range_y(plot *p, double low, double high) {
    panel *a = current(p);
    if (a) set_range(&a->y, low, high);
}

void plot_equal(plot *p) {
    panel *a = current(p);
    if (a) a->equal = true;
}

void plot_legend_outside(plot *p) {
    panel *a = current(p);
    if (a) a->legend_outside = true;
}

static series *add(plot *p, series_kind kind, const char *label, int n) {
    panel *a = current(p);
    if (!a) return NULL;
    if (a->n == a->capacity) {
        int capacity = 2 * a->capacity + 8;
        series *larger = realloc(a->all, (size_t)capacity * sizeof *larger);
        if (!larger) {
            p->failed = true;
            return NULL;
        }
        a->all = larger;
        a->capacity = capacity;
    }
    series *s = &a->all[a->n++];
    memset(s, 0, sizeof *s);
    s->kind = kind;
    s->label = copy_text(p, label);
    s->n = n > 0 ? n : 0;
    s->colour = PLOT_GREY;
    return s;
}

static series *add_coloured(plot *p, series_kind kind, const char *label, const double *x, const double *y, const double *z, int n) {
    series *s = add(p, kind, label, n);
    if (!s) return NULL;
    s->x = copy_numbers(p, x, n);
    s->y = copy_numbers(p, y, n);
    s->z = copy_numbers(p, z, n);
    if ((x && !s->x) || (y && !s->y) || (z && !s->z)) s->n = 0;
    s->colour = current(p)->next_colour++ % 8;
    return s;
}

void plot_line(plot *p, const char *label, const double *x, const double *y, int n) { add_coloured(p, LINE, label, x, y, NULL, n); }

void plot_points(plot *p, const char *label, const double *x, const double *y, int n) { add_coloured(p, POINTS, label, x, y, NULL, n); }

void plot_band(plot *p, const char *label, const double *x, const double *low, const double *high, int n) {
    add_coloured(p, BAND, label, x, low, high, n);
}

void plot_error_bars(plot *p, const char *label, const double *x, const double *y, const double *plus_minus, int n) {
    add_coloured(p, ERROR_BARS, label, x, y, plus_minus, n);
}

void plot_bars(plot *p, const char *label, const char *const *names, const double *values, int n) {
    series *s = add_coloured(p, BARS, label, NULL, values, NULL, n);
    if (!s || s->n == 0) return;
    s->names = calloc((size_t)s->n, sizeof *s->names);
    if (!s->names) p->failed = true;
    for (int i = 0; s->names && i < s->n; i++) s->names[i] = copy_text(p, names[i]);
}

void plot_heat(plot *p, const char *label, const double *values, int columns, int rows, double x0, double x1, double y0, double y1) {
    double corners[4] = {x0, x1, y0, y1};
    if (columns < 1 || rows < 1 || columns > 100000000 / rows) return;
    series *s = add(p, HEAT, label, 4);
    if (!s) return;
    s->x = copy_numbers(p, corners, 4);
    s->y = copy_numbers(p, values, columns * rows);
    s->columns = columns;
    s->rows = rows;
    if (!s->x || !s->y) s->n = 0;
}

void plot_heat_range(plot *p, double low, double high) {
    panel *a = current(p);
    const double ends[2] = {low, high};
    if (!a || a->n == 0 || a->all[a->n - 1].kind != HEAT || !(low < high) || !(high - low < HUGE_VAL)) return;
    free(a->all[a->n - 1].z);
    a->all[a->n - 1].z = copy_numbers(p, ends, 2);
}

void plot_style(plot *p, int flags, int colour) {
    panel *a = current(p);
    if (!a || a->n == 0) return;
    series *s = &a->all[a->n - 1];
    s->flags = flags;
    if (colour == PLOT_NEXT) return;
    if (s->kind <= BARS) a->next_colour--; /* it gives back the colour that it took */
    if (colour == PLOT_SAME) s->colour = a->n > 1 ? a->all[a->n - 2].colour : 0;
    else s->colour = colour >= 0 ? colour % 8 : colour;
}

static void add_at(plot *p, series_kind kind, const char *label, double x, double y) {
    series *s = add(p, kind, label, 1);
    if (!s) return;
    s->x = copy_numbers(p, &x, 1);
    s->y = copy_numbers(p, &y, 1);
    if (!s->x || !s->y) s->n = 0;
}

void plot_horizontal(plot *p, const char *label, double y) { add_at(p, HORIZONTAL, label, 0.0, y); }

void plot_vertical(plot *p, const char *label, double x) { add_at(p, VERTICAL, label, x, 0.0); }

void plot_text(plot *p, double x, double y, const char *text) { add_at(p, TEXT, text, x, y); }

void plot_text_share(plot *p, double x_share, double y_share, const char *text) { add_at(p, TEXT_SHARE, text, x_share, y_share); }

/* ---- axes ---- */

static bool can_show(const axis *a, double v) { return v - v == 0.0 && (!a->log || v > 0.0); }

static void include(const axis *a, double v, double *low, double *high) {
    if (!can_show(a, v)) return;
    if (v < *low) *low = v;
    if (v > *high) *high = v;
}

/* From the data's range to the axis' range. */
static void settle(axis *a, double low, double high, bool tight) {
    if (a->fixed_range && can_show(a, a->low)) return;
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

/* 0 .. 1 along the axis */
static double share(const axis *a, double v) {
    if (a->log) return (log(v) - log(a->low)) / (log(a->high) - log(a->low)); /* a quotient could overflow */
    return (v - a->low) / (a->high - a->low);
}

typedef struct {
    double at;
    bool major;
    char text[80]; /* SVG, with a raised exponent where needed */
    int letters;
} tick;

enum { MOST_TICKS = 120 };

static void replace_minus(char *text, size_t size) {
    size_t length = strlen(text);
    if (text[0] != '-' || length + 3 > size) return;
    memmove(text + 3, text + 1, length);
    memcpy(text, "\xE2\x88\x92", 3);
}

static int letters_of(const char *text) {
    int n = 0;
    for (; *text; text++) n += ((unsigned char)*text & 0xC0) != 0x80;
    return n;
}

/* A step of 1, 2, 5 x 10^k that gives about `wanted` intervals; *minor: intervals between two. */
static double nice_step(double span, int wanted, int *minor) {
    double raw = span / wanted, power = pow(10.0, floor(log10(raw))), m = raw / power;
    *minor = m > 1.41 && m <= 3.16 ? 4 : 5;
    return power * (m <= 1.41 ? 1.0 : m <= 3.16 ? 2.0 : m <= 7.07 ? 5.0 : 10.0);
}

/* exponent: 10^exponent is divided out of the labels and stands at the end of the axis. */
static int linear_ticks(const axis *a, int wanted, tick *ticks, int *exponent) {
    int minor, n = 0;
    double step = nice_step(a->high - a->low, wanted, &minor), fine = step / minor, largest = fmax(fabs(a->low), fabs(a->high));
    int size = largest > 0.0 ? (int)floor(log10(largest) + 1e-9) : 0, digits = (int)floor(log10(step) + 1e-9);
    *exponent = size >= 6 || size <= -3 ? 3 * (int)floor(size / 3.0) : 0;
    int decimals = *exponent - digits;
    if (decimals < 0) decimals = 0;
    if (decimals > 12) decimals = 12;
    for (double k = ceil(a->low / fine - 1e-9); k * fine <= a->high + 1e-9 * step && n < MOST_TICKS; k += 1.0) {
        tick *t = &ticks[n++];
        t->at = k * fine;
        t->major = fabs(k / minor - floor(k / minor + 0.5)) < 1e-6;
        double shown = t->at / pow(10.0, *exponent);
        if (fabs(t->at) < 1e-9 * step) shown = 0.0;
        snprintf(t->text, sizeof t->text, "%.*f", decimals, shown);
        replace_minus(t->text, sizeof t->text);
        t->letters = letters_of(t->text);
        if (t->at < a->low) t->at = a->low;
        if (t->at > a->high) t->at = a->high;
    }
    return n;
}

/* m x 10^exponent */
static void power_text(tick *t, int m, int exponent, bool plain) {
    char raised[20], front[10] = "";
    if (plain) {
        snprintf(t->text, sizeof t->text, "%.*f", exponent < 0 ? -exponent : 0, m * pow(10.0, exponent));
        t->letters = (int)strlen(t->text);
        return;
    }
    snprintf(raised, sizeof raised, "%d", exponent);
    replace_minus(raised, sizeof raised);
    if (m != 1) snprintf(front, sizeof front, "%d\xC3\x97", m % 10);
    snprintf(t->text, sizeof t->text, "%s10<tspan class=\"up\" dy=\"-6\">%s</tspan>", front, raised);
    t->letters = letters_of(front) + 2 + letters_of(raised);
}

static int log_ticks(const axis *a, int wanted, tick *ticks) {
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
        for (int m = 1; m <= 9 && n < MOST_TICKS; m++) {
            if (every > 1 && m > 1) continue;
            double v = m * pow(10.0, e);
            if (v < a->low * (1.0 - 1e-9) || v > a->high * (1.0 + 1e-9)) continue;
            tick *t = &ticks[n++];
            t->at = v;
            t->major = m == 1 && e % every == 0;
            t->letters = 0;
            t->text[0] = '\0';
            if (few && (m == 2 || m == 5 || steps_shown <= 6)) t->major = true; /* too few powers of ten to read it by */
            if (t->major) power_text(t, m, e, plain);
        }
    }
    return n;
}

/* A log axis within a factor of two has no useful powers of ten on it. */
static int make_ticks(const axis *a, int wanted, tick *ticks, int *exponent) {
    *exponent = 0;
    if (a->log && a->high / a->low > 2.0) return log_ticks(a, wanted, ticks);
    return linear_ticks(a, wanted, ticks, exponent);
}

/* ---- text widths, by the average letter of a sans-serif face ---- */

static double text_width(const char *text, double size) {
    double w = 0.0;
    for (; *text; text++) {
        if (((unsigned char)*text & 0xC0) == 0x80) continue;
        w += strchr("iljtfr.,:;'|()[] ", *text) ? 0.33 : strchr("mwMW", *text) ? 0.85 : *text >= 'A' && *text <= 'Z' ? 0.67 : 0.56;
    }
    return w * size;
}

/* ---- SVG ---- */

static void escaped(output *f, const char *text) {
    for (; text && *text; text++) {
        if (*text == '&') output_print(f, "&amp;");
        else if (*text == '<') output_print(f, "&lt;");
        else if (*text == '>') output_print(f, "&gt;");
        else if ((unsigned char)*text >= 32) output_write(f, text, 1);
    }
}

static void text_at(output *f, double x, double y, const char *anchor, const char *style, const char *text) {
    if (!text || !*text) return;
    output_print(f, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" class=\"%s\">", x, y, anchor, style);
    escaped(f, text);
    output_print(f, "</text>\n");
}

static const char *colour_of(const series *s) {
    if (s->colour == PLOT_GREY) return "#888888";
    if (s->colour == PLOT_BLACK) return "#222222";
    return palette[s->colour & 7];
}

/* viridis (van der Walt & Smith 2015) at nine places */
static void heat_colour(double share01, int rgb[3]) {
    static const int map[9][3] = {{68, 1, 84},    {71, 44, 122}, {59, 81, 139},  {44, 113, 142}, {33, 144, 141},
                                  {39, 173, 129}, {92, 200, 99}, {170, 220, 50}, {253, 231, 37}};
    double s = share01 < 0.0 ? 0.0 : share01 > 1.0 ? 8.0 : 8.0 * share01;
    int k = s >= 8.0 ? 7 : (int)s;
    for (int i = 0; i < 3; i++) rgb[i] = (int)(map[k][i] + (s - k) * (map[k + 1][i] - map[k][i]) + 0.5);
}

static double px(const panel *a, double x) { return a->at.x + a->at.width * share(&a->x, x); }

static double py(const panel *a, double y) { return a->at.y + a->at.height * (1.0 - share(&a->y, y)); }

static bool visible(const panel *a, double x, double y) { return can_show(&a->x, x) && can_show(&a->y, y); }

/* Far-away points stay within what a renderer can take. */
static double limited(double v) { return v < -1e5 ? -1e5 : v > 1e5 ? 1e5 : v; }

static void draw_path(output *f, const panel *a, const series *s) {
    const char *dash = s->flags & PLOT_DASHED ? " stroke-dasharray=\"8 5\"" : s->flags & PLOT_DOTTED ? " stroke-dasharray=\"2 4\"" : "";
    double width = s->flags & PLOT_THIN ? 1.1 : 2.4;
    output_print(f, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"%.1f\" stroke-linejoin=\"round\" stroke-linecap=\"round\"%s%s d=\"",
                 colour_of(s), width, dash, s->flags & PLOT_FAINT ? " stroke-opacity=\"0.35\"" : "");
    bool pen_down = false;
    double last_x = 0.0, last_y = 0.0;
    for (int i = 0; i < s->n; i++) {
        if (!visible(a, s->x[i], s->y[i])) {
            pen_down = false;
            continue;
        }
        double x = limited(px(a, s->x[i])), y = limited(py(a, s->y[i]));
        bool last = i + 1 == s->n || !visible(a, s->x[i + 1], s->y[i + 1]);
        if (pen_down && !last && fabs(x - last_x) < 0.3 && fabs(y - last_y) < 0.3) continue;
        if (pen_down && s->flags & PLOT_STEPS) output_print(f, "H%.2f", x);
        output_print(f, "%s%.2f %.2f", pen_down ? "L" : "M", x, y);
        pen_down = true;
        last_x = x;
        last_y = y;
    }
    output_print(f, "\"/>\n");
}

/* A shape for each colour, for those who do not see the colours. */
static void draw_marker(output *f, const series *s, double x, double y, double r) {
    switch (s->colour < 0 ? 0 : s->colour % 4) {
    case 1:
        output_print(f, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\"/>\n", x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r);
        break;
    case 2: output_print(f, "<path d=\"M%.2f %.2fl%.2f %.2fh%.2fz\"/>\n", x, y - 1.2 * r, 1.15 * r, 2.0 * r, -2.3 * r); break;
    case 3:
        output_print(f, "<path d=\"M%.2f %.2fl%.2f %.2fl%.2f %.2fl%.2f %.2fz\"/>\n", x, y - 1.3 * r, 1.3 * r, 1.3 * r, -1.3 * r, 1.3 * r,
                     -1.3 * r, -1.3 * r);
        break;
    default: output_print(f, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\"/>\n", x, y, r);
    }
}

static void draw_points(output *f, const panel *a, const series *s) {
    double r = s->n > 1500 ? 1.4 : s->n > 200 || s->flags & PLOT_THIN ? 2.4 : 4.0;
    output_print(f, "<g fill=\"%s\" stroke=\"white\" stroke-width=\"%s\"%s>\n", colour_of(s), r > 3.0 ? "0.8" : "0",
                 s->n > 200 || s->flags & PLOT_FAINT ? " fill-opacity=\"0.55\"" : "");
    for (int i = 0; i < s->n; i++) {
        if (!visible(a, s->x[i], s->y[i])) continue;
        double u = share(&a->x, s->x[i]), v = share(&a->y, s->y[i]);
        if (u < -1e-6 || u > 1.0 + 1e-6 || v < -1e-6 || v > 1.0 + 1e-6) continue;
        draw_marker(f, s, px(a, s->x[i]), py(a, s->y[i]), r);
    }
    output_print(f, "</g>\n");
}

static double floor_of(const axis *a, double v) { return a->log && !(v > 0.0) ? a->low : v; }

static void draw_band(output *f, const panel *a, const series *s) {
    for (int i = 0; i < s->n;) {
        int end = i;
        while (end < s->n && visible(a, s->x[end], s->z[end]) && s->y[end] - s->y[end] == 0.0) end++;
        if (end - i > 1) {
            output_print(f, "<path fill=\"%s\" fill-opacity=\"0.22\" d=\"", colour_of(s));
            for (int k = i; k < end; k++)
                output_print(f, "%s%.2f %.2f", k == i ? "M" : "L", limited(px(a, s->x[k])), limited(py(a, s->z[k])));
            for (int k = end - 1; k >= i; k--)
                output_print(f, "L%.2f %.2f", limited(px(a, s->x[k])), limited(py(a, floor_of(&a->y, s->y[k]))));
            output_print(f, "Z\"/>\n");
        }
        i = end > i ? end : i + 1;
    }
}

static bool has_length(const series *s, int i) { return s->z[i] >= 0.0 && s->z[i] < HUGE_VAL; }

static void draw_error_bars(output *f, const panel *a, const series *s) {
    output_print(f, "<g stroke=\"%s\" stroke-width=\"1.6\">\n", colour_of(s));
    for (int i = 0; i < s->n; i++) {
        if (!visible(a, s->x[i], s->y[i]) || !has_length(s, i)) continue;
        double x = limited(px(a, s->x[i])), top = limited(py(a, s->y[i] + s->z[i])),
               base = limited(py(a, floor_of(&a->y, s->y[i] - s->z[i])));
        output_print(f, "<path d=\"M%.2f %.2fh8m-4 0V%.2fm-4 0h8\"/>\n", x - 4.0, top, base);
    }
    output_print(f, "</g>\n");
    draw_points(f, a, s);
}

/* Which of the bar series this one is, and how many there are. */
static void bar_place(const panel *a, const series *s, int *index, int *count) {
    *index = *count = 0;
    for (int i = 0; i < a->n; i++) {
        if (a->all[i].kind != BARS) continue;
        if (&a->all[i] == s) *index = *count;
        ++*count;
    }
}

static void bar_edges(const panel *a, const series *s, int i, double *left, double *right) {
    int index, count;
    bar_place(a, s, &index, &count);
    double width = 0.78 / count;
    *left = i - 0.39 + width * index;
    *right = *left + width * (count > 1 ? 0.94 : 1.0);
}

static void draw_bars(output *f, const panel *a, const series *s) {
    for (int i = 0; i < s->n; i++) {
        double left, right, base = a->y.log ? a->y.low : fmax(0.0, a->y.low);
        if (!can_show(&a->y, s->y[i])) continue;
        bar_edges(a, s, i, &left, &right);
        double y0 = limited(py(a, base)), y1 = limited(py(a, s->y[i])), top = fmin(y0, y1);
        output_print(f, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"%s\"/>\n", px(a, left), top,
                     px(a, right) - px(a, left), fabs(y1 - y0), colour_of(s));
    }
}

static void heat_range(const series *s, double *low, double *high) {
    if (s->z) {
        *low = s->z[0];
        *high = s->z[1];
        return;
    }
    static const axis plain = {0.0, 1.0, false, false, NULL};
    *low = HUGE_VAL;
    *high = -HUGE_VAL;
    for (int i = 0; i < s->columns * s->rows; i++) include(&plain, s->y[i], low, high);
    if (!(*low <= *high)) {
        *low = 0.0;
        *high = 1.0;
    }
    *low = fmin(fmax(*low, -1e300), 1e300); /* so that their difference is finite */
    *high = fmin(fmax(*high, -1e300), 1e300);
    if (!(*high > *low)) *high = *low + (*low != 0.0 ? fabs(*low) : 1.0);
}

static double between(double from, double to, int i, int n) { return from * (1.0 - (double)i / n) + to * ((double)i / n); }

/* 0 .. 160, or -1 where there is no number */
static int heat_level(double v, double low, double high) {
    return v - v == 0.0 ? (int)(160.0 * fmin(fmax((v - low) / (high - low), 0.0), 1.0)) : -1;
}

/* Neighbours of one colour in a row are one rectangle. */
static void draw_heat(output *f, const panel *a, const series *s) {
    double low, high;
    if (s->n == 0 || !visible(a, s->x[0], s->x[2]) || !visible(a, s->x[1], s->x[3])) return;
    heat_range(s, &low, &high);
    output_print(f, "<g shape-rendering=\"crispEdges\">\n");
    for (int row = 0; row < s->rows; row++) {
        double y0 = between(s->x[2], s->x[3], row, s->rows), y1 = between(s->x[2], s->x[3], row + 1, s->rows);
        double top = fmin(py(a, y0), py(a, y1)), height = fabs(py(a, y1) - py(a, y0));
        for (int i = 0, end; i < s->columns; i = end) {
            const double *values = s->y + (size_t)row * (size_t)s->columns;
            int level = heat_level(values[i], low, high), rgb[3];
            for (end = i + 1; end < s->columns && heat_level(values[end], low, high) == level;) end++;
            if (level < 0) continue;
            heat_colour((level + 0.5) / 161.0, rgb);
            double x0 = px(a, between(s->x[0], s->x[1], i, s->columns)), x1 = px(a, between(s->x[0], s->x[1], end, s->columns));
            output_print(f, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" fill=\"#%02x%02x%02x\"/>\n", fmin(x0, x1), top,
                         fabs(x1 - x0) + 0.3, height + 0.3, (unsigned)rgb[0], (unsigned)rgb[1], (unsigned)rgb[2]);
        }
    }
    output_print(f, "</g>\n");
}

static void draw_colour_bar(output *f, const panel *a, const series *s) {
    double low, high;
    heat_range(s, &low, &high);
    axis scale = {low, high, false, false, NULL};
    tick ticks[MOST_TICKS];
    int exponent, n = make_ticks(&scale, 5, ticks, &exponent);
    double x = a->at.x + a->at.width + 16.0, y = a->at.y, height = a->at.height, widest = 0.0;
    output_print(f, "<g shape-rendering=\"crispEdges\">\n");
    for (int i = 0; i < 64; i++) {
        int rgb[3];
        heat_colour((i + 0.5) / 64.0, rgb);
        output_print(f, "<rect x=\"%.1f\" y=\"%.2f\" width=\"14\" height=\"%.2f\" fill=\"#%02x%02x%02x\"/>\n", x,
                     y + height * (63 - i) / 64.0, height / 64.0 + 0.4, (unsigned)rgb[0], (unsigned)rgb[1], (unsigned)rgb[2]);
    }
    output_print(f, "</g>\n");
    for (int i = 0; i < n; i++) {
        if (!ticks[i].major) continue;
        double at = y + height * (1.0 - share(&scale, ticks[i].at));
        output_print(f, "<path d=\"M%.1f %.1fh5\" stroke=\"#333\"/><text x=\"%.1f\" y=\"%.1f\" class=\"tick\">%s</text>\n", x + 14.0, at,
                     x + 23.0, at + 5.0, ticks[i].text);
        widest = fmax(widest, 0.58 * TICK_SIZE * ticks[i].letters);
    }
    if (exponent)
        output_print(f,
                     "<text x=\"%.1f\" y=\"%.1f\" class=\"tick\">\xC3\x97"
                     "10<tspan class=\"up\" dy=\"-6\">%s%d</tspan></text>\n",
                     x, y - 7.0, exponent < 0 ? "\xE2\x88\x92" : "", abs(exponent));
    if (s->label && *s->label) {
        double lx = x + 23.0 + widest + 16.0, ly = y + 0.5 * height;
        output_print(f, "<text transform=\"translate(%.1f %.1f) rotate(-90)\" text-anchor=\"middle\" class=\"label\">", lx, ly);
        escaped(f, s->label);
        output_print(f, "</text>\n");
    }
}

static void draw_reference(output *f, const panel *a, const series *s) {
    bool horizontal = s->kind == HORIZONTAL;
    double v = horizontal ? s->y[0] : s->x[0];
    const axis *along = horizontal ? &a->y : &a->x;
    if (!can_show(along, v) || share(along, v) < 0.0 || share(along, v) > 1.0) return;
    const char *dash = s->flags & PLOT_DOTTED ? "2 4" : "6 4";
    if (horizontal) {
        double y = py(a, v);
        output_print(f, "<path d=\"M%.1f %.2fh%.1f\" stroke=\"%s\" stroke-width=\"1.5\" stroke-dasharray=\"%s\"/>\n", a->at.x, y,
                     a->at.width, colour_of(s), dash);
        text_at(f, a->at.x + a->at.width - 6.0, y - 5.0, "end", "note", s->label);
    } else {
        double x = px(a, v), width = s->label ? text_width(s->label, TICK_SIZE) : 0.0;
        bool right = x + width + 8.0 < a->at.x + a->at.width;
        output_print(f, "<path d=\"M%.2f %.1fv%.1f\" stroke=\"%s\" stroke-width=\"1.5\" stroke-dasharray=\"%s\"/>\n", x, a->at.y,
                     a->at.height, colour_of(s), dash);
        text_at(f, right ? x + 5.0 : x - 5.0, a->at.y + 16.0, right ? "start" : "end", "note", s->label);
    }
}

static void draw_text(output *f, const panel *a, const series *s) {
    double x, y;
    if (s->kind == TEXT_SHARE) {
        x = a->at.x + a->at.width * s->x[0];
        y = a->at.y + a->at.height * (1.0 - s->y[0]);
    } else {
        if (!visible(a, s->x[0], s->y[0])) return;
        x = limited(px(a, s->x[0]));
        y = limited(py(a, s->y[0]));
    }
    text_at(f, x, y, "start", "note", s->label);
}

static void draw_series(output *f, const panel *a, const series *s) {
    if (s->n == 0) return;
    switch (s->kind) {
    case LINE:
        if (!(s->flags & PLOT_NO_LINE)) draw_path(f, a, s);
        if (s->flags & PLOT_MARKED) draw_points(f, a, s);
        break;
    case POINTS: draw_points(f, a, s); break;
    case BAND: draw_band(f, a, s); break;
    case ERROR_BARS: draw_error_bars(f, a, s); break;
    case BARS: draw_bars(f, a, s); break;
    case HEAT: draw_heat(f, a, s); break;
    case HORIZONTAL:
    case VERTICAL: draw_reference(f, a, s); break;
    case TEXT:
    case TEXT_SHARE: draw_text(f, a, s); break;
    }
}

/* ---- layout ---- */

static double entry_width(const series *s) { return SWATCH + 3 * PAD + text_width(s->label, TICK_SIZE); }
static bool in_legend(const series *s) { return s->label && *s->label && (s->kind <= BARS); }

static const series *first_of(const panel *a, series_kind kind) {
    for (int i = 0; i < a->n; i++)
        if (a->all[i].kind == kind && a->all[i].n > 0) return &a->all[i];
    return NULL;
}

static void find_ranges(panel *a) {
    double x0 = HUGE_VAL, x1 = -HUGE_VAL, y0 = HUGE_VAL, y1 = -HUGE_VAL;
    bool tight = false;
    const series *bars = first_of(a, BARS);
    for (int k = 0; k < a->n; k++) {
        const series *s = &a->all[k];
        if (s->n == 0 || s->kind == TEXT || s->kind == TEXT_SHARE) continue;
        if (s->kind == HEAT) {
            tight = true;
            for (int i = 0; i < 2; i++) {
                include(&a->x, s->x[i], &x0, &x1);
                include(&a->y, s->x[2 + i], &y0, &y1);
            }
            continue;
        }
        for (int i = 0; i < s->n; i++) {
            if (s->x && s->kind != HORIZONTAL && (!s->y || s->kind == VERTICAL || can_show(&a->y, s->y[i])))
                include(&a->x, s->x[i], &x0, &x1);
            if (s->kind == VERTICAL || (s->x && s->kind != HORIZONTAL && !can_show(&a->x, s->x[i]))) continue;
            if (a->x.fixed_range && s->x && s->kind != HORIZONTAL && (s->x[i] < a->x.low || s->x[i] > a->x.high)) continue;
            include(&a->y, s->y[i], &y0, &y1);
            if (s->kind == BAND) include(&a->y, s->z[i], &y0, &y1);
            if (s->kind == ERROR_BARS && has_length(s, i)) {
                include(&a->y, s->y[i] - s->z[i], &y0, &y1);
                include(&a->y, s->y[i] + s->z[i], &y0, &y1);
            }
        }
    }
    if (bars) {
        a->x.log = false;
        if (!a->y.log) include(&a->y, 0.0, &y0, &y1);
        set_range(&a->x, -0.6, bars->n - 0.4);
    }
    settle(&a->x, x0, x1, tight);
    settle(&a->y, y0, y1, tight);
}

static void keep_equal(panel *a) {
    if (!a->equal || a->x.log || a->y.log) return;
    double x_unit = a->at.width / (a->x.high - a->x.low), y_unit = a->at.height / (a->y.high - a->y.low);
    axis *wider = x_unit > y_unit ? &a->x : &a->y;
    double factor = x_unit > y_unit ? x_unit / y_unit : y_unit / x_unit, middle = 0.5 * (wider->low + wider->high);
    double half = 0.5 * factor * (wider->high - wider->low);
    if (!(half < 1e300)) return;
    wider->low = middle - half;
    wider->high = middle + half;
}

static int ticks_along(double length, double spacing) {
    int n = (int)(length / spacing);
    return n < 2 ? 2 : n > 9 ? 9 : n;
}

static bool slanted_names(const panel *a, const series *bars) {
    for (int i = 0; i < bars->n; i++)
        if (bars->names && bars->names[i] && text_width(bars->names[i], TICK_SIZE) > 0.95 * a->at.width / bars->n) return true;
    return false;
}

/* Where the data are, on a coarse raster of the panel, so that the legend can stand where they are not. */
enum { RASTER_X = 72, RASTER_Y = 48 };
typedef bool raster[RASTER_Y][RASTER_X];

static void stain(raster r, const panel *a, double x, double y, double reach) {
    double u = (x - a->at.x) / a->at.width, v = (y - a->at.y) / a->at.height;
    int i0 = (int)floor((u - reach / a->at.width) * RASTER_X), i1 = (int)floor((u + reach / a->at.width) * RASTER_X);
    int j0 = (int)floor((v - reach / a->at.height) * RASTER_Y), j1 = (int)floor((v + reach / a->at.height) * RASTER_Y);
    for (int j = j0 < 0 ? 0 : j0; j <= j1 && j < RASTER_Y; j++)
        for (int i = i0 < 0 ? 0 : i0; i <= i1 && i < RASTER_X; i++) r[j][i] = true;
}

static void stain_segment(raster r, const panel *a, double x0, double y0, double x1, double y1) {
    double longest = fmax(fabs(x1 - x0) / a->at.width * RASTER_X, fabs(y1 - y0) / a->at.height * RASTER_Y);
    int steps = 1 + (int)fmin(2.0 * longest, 2000.0);
    for (int k = 0; k <= steps; k++) stain(r, a, x0 + (x1 - x0) * k / steps, y0 + (y1 - y0) * k / steps, 3.0);
}

static void stain_series(raster r, const panel *a, const series *s) {
    if (s->kind == HEAT) {
        memset(r, 1, sizeof(raster));
        return;
    }
    for (int i = 0; i < s->n; i++) {
        if (s->kind == BARS) {
            double left, right;
            if (!can_show(&a->y, s->y[i])) continue;
            bar_edges(a, s, i, &left, &right);
            double base = a->y.log ? a->y.low : fmax(0.0, a->y.low);
            for (int k = 0; k <= 8; k++) {
                double x = px(a, left + (right - left) * k / 8.0);
                stain_segment(r, a, x, limited(py(a, base)), x, limited(py(a, s->y[i])));
            }
        } else if (s->kind == HORIZONTAL && can_show(&a->y, s->y[i])) {
            double y = limited(py(a, s->y[i])), end = a->at.x + a->at.width;
            stain_segment(r, a, a->at.x, y, end, y);
            if (s->label)
                for (int k = 0; k < 3; k++) stain_segment(r, a, end - text_width(s->label, TICK_SIZE) - 6.0, y - 7.0 * k, end, y - 7.0 * k);
        } else if (s->kind == VERTICAL && can_show(&a->x, s->x[i])) {
            double x = limited(px(a, s->x[i]));
            stain_segment(r, a, x, a->at.y, x, a->at.y + a->at.height);
            if (s->label && *s->label) {
                double width = text_width(s->label, TICK_SIZE) + 10.0, start = x + width < a->at.x + a->at.width ? x : x - width;
                for (int k = 0; k < 3; k++) stain_segment(r, a, start, a->at.y + 7.0 * k, start + width, a->at.y + 7.0 * k);
            }
        } else if ((s->kind == TEXT && visible(a, s->x[i], s->y[i])) || s->kind == TEXT_SHARE) {
            double x = s->kind == TEXT ? limited(px(a, s->x[i])) : a->at.x + a->at.width * s->x[i];
            double y = s->kind == TEXT ? limited(py(a, s->y[i])) : a->at.y + a->at.height * (1.0 - s->y[i]);
            for (int k = 0; k < 3 && s->label; k++) stain_segment(r, a, x, y - 6.0 * k, x + text_width(s->label, TICK_SIZE), y - 6.0 * k);
        } else if (s->kind <= ERROR_BARS && visible(a, s->x[i], s->y[i])) {
            double x = limited(px(a, s->x[i])), y = limited(py(a, s->y[i]));
            stain(r, a, x, y, s->kind == LINE && !(s->flags & PLOT_MARKED) ? 3.0 : 6.0);
            if (s->kind == ERROR_BARS && has_length(s, i))
                stain_segment(r, a, x, limited(py(a, s->y[i] + s->z[i])), x, limited(py(a, floor_of(&a->y, s->y[i] - s->z[i]))));
            if (s->kind == BAND && can_show(&a->y, s->z[i])) stain_segment(r, a, x, y, x, limited(py(a, s->z[i])));
            bool joined = s->kind == LINE || s->kind == BAND;
            if (joined && i + 1 < s->n && visible(a, s->x[i + 1], s->y[i + 1])) {
                stain_segment(r, a, x, y, limited(px(a, s->x[i + 1])), limited(py(a, s->y[i + 1])));
                if (s->kind == BAND && visible(a, s->x[i + 1], s->z[i + 1]) && can_show(&a->y, s->z[i]))
                    stain_segment(r, a, x, limited(py(a, s->z[i])), limited(px(a, s->x[i + 1])), limited(py(a, s->z[i + 1])));
            }
        }
    }
}

/* A free place inside for the legend, nearest to a corner, the right ones first. */
static bool place_inside(panel *a) {
    raster r;
    memset(r, 0, sizeof r);
    for (int k = 0; k < a->n; k++) stain_series(r, a, &a->all[k]);
    int w = (int)ceil(a->at.legend_width / a->at.width * RASTER_X) + 1, h = (int)ceil(a->at.legend_height / a->at.height * RASTER_Y) + 1;
    double best = HUGE_VAL;
    for (int j = 1; j + h < RASTER_Y; j++)
        for (int i = 1; i + w < RASTER_X; i++) {
            bool free_place = true;
            for (int jj = j; jj < j + h && free_place; jj++)
                for (int ii = i; ii < i + w && free_place; ii++) free_place = !r[jj][ii];
            if (!free_place) continue;
            int from_right = RASTER_X - 1 - (i + w), from_bottom = RASTER_Y - 1 - (j + h);
            double aside = from_right <= i - 1 ? from_right : i - 1 + 0.4, up = j - 1 <= from_bottom ? j - 1 : from_bottom + 0.8;
            if (aside * aside + up * up < best) {
                best = aside * aside + up * up;
                a->at.legend_x = a->at.x + a->at.width * i / RASTER_X;
                a->at.legend_y = a->at.y + a->at.height * j / RASTER_Y;
            }
        }
    return best < HUGE_VAL;
}

/* Everything but the place in the figure, which starts at 0, 0. */
static void lay_out(const plot *p, panel *a) {
    tick ticks[MOST_TICKS];
    int exponent, n, entries = 0;
    a->at.width = p->width;
    a->at.height = p->height;
    a->at.x = a->at.y = 0.0;
    find_ranges(a);
    keep_equal(a);
    double widest = 0.0;
    n = make_ticks(&a->y, ticks_along(a->at.height, 48.0), ticks, &exponent);
    for (int i = 0; i < n; i++)
        if (ticks[i].major) widest = fmax(widest, 0.58 * TICK_SIZE * ticks[i].letters);
    a->at.left = 14.0 + widest + (a->y.label ? LABEL_SIZE + 12.0 : 0.0);
    a->at.top = (a->title ? TITLE_SIZE + 12.0 : 8.0) + (exponent ? 14.0 : 0.0);
    a->at.bottom = 28.0 + (a->x.label ? LABEL_SIZE + 12.0 : 0.0);
    a->at.right = 20.0;
    const series *bars = first_of(a, BARS), *heat = first_of(a, HEAT);
    if (bars && slanted_names(a, bars)) {
        double longest = 0.0;
        for (int i = 0; i < bars->n; i++)
            if (bars->names && bars->names[i]) longest = fmax(longest, text_width(bars->names[i], TICK_SIZE));
        a->at.bottom += 0.55 * longest;
        a->at.left = fmax(a->at.left, 0.84 * longest - 0.5 * a->at.width / bars->n + 10.0);
    }
    if (heat) {
        double low, high, digits = 0.0;
        heat_range(heat, &low, &high);
        axis scale = {low, high, false, false, NULL};
        n = make_ticks(&scale, 5, ticks, &exponent);
        for (int i = 0; i < n; i++)
            if (ticks[i].major) digits = fmax(digits, 0.58 * TICK_SIZE * ticks[i].letters);
        a->at.right += 16.0 + 23.0 + digits + (heat->label && *heat->label ? 26.0 : 0.0);
    }
    double in_a_row = 0.0;
    a->at.legend_width = 0.0;
    for (int k = 0; k < a->n; k++)
        if (in_legend(&a->all[k])) {
            entries++;
            a->at.legend_width = fmax(a->at.legend_width, entry_width(&a->all[k]));
            in_a_row += entry_width(&a->all[k]);
        }
    a->at.legend_height = entries * LEGEND_ROW + PAD;
    if (!entries || (!a->legend_outside && place_inside(a))) return;
    a->legend_above = !a->legend_outside && in_a_row < a->at.width - 30.0; /* the left end may hold the axis' exponent */
    if (a->legend_above) {
        a->at.legend_x = a->at.width - in_a_row;
        a->at.legend_y = -LEGEND_ROW - PAD / 2.0;
        a->at.top = (a->title ? TITLE_SIZE + 8.0 : 0.0) + LEGEND_ROW + PAD;
    } else {
        a->legend_outside = true;
        a->at.legend_x = a->at.width + a->at.right - 6.0;
        a->at.legend_y = 0.0;
        a->at.right += a->at.legend_width + 4.0;
        a->at.bottom = fmax(a->at.bottom, a->at.legend_height - a->at.height + 8.0);
    }
}

static void draw_axes(output *f, const panel *a) {
    tick ticks[MOST_TICKS];
    const layout *at = &a->at;
    const series *bars = first_of(a, BARS);
    int exponent, n;
    output_print(f, "<g class=\"grid\">\n");
    if (!bars) {
        n = make_ticks(&a->x, ticks_along(at->width, 78.0), ticks, &exponent);
        for (int i = 0; i < n; i++)
            output_print(f, "<path%s d=\"M%.2f %.1fv%.1f\"/>\n", ticks[i].major ? "" : " class=\"minor\"", px(a, ticks[i].at), at->y,
                         at->height);
    }
    n = make_ticks(&a->y, ticks_along(at->height, 48.0), ticks, &exponent);
    for (int i = 0; i < n; i++)
        output_print(f, "<path%s d=\"M%.1f %.2fh%.1f\"/>\n", ticks[i].major ? "" : " class=\"minor\"", at->x, py(a, ticks[i].at),
                     at->width);
    output_print(f, "</g>\n");
}

static void draw_frame(output *f, const panel *a) {
    tick ticks[MOST_TICKS];
    const layout *at = &a->at;
    const series *bars = first_of(a, BARS);
    int exponent, n;
    double base = at->y + at->height;
    output_print(f, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" class=\"frame\"/>\n", at->x, at->y, at->width, at->height);
    double names_height = 0.0;
    if (bars) {
        bool slanted = slanted_names(a, bars);
        for (int i = 0; i < bars->n && bars->names; i++) {
            const char *name = bars->names[i] ? bars->names[i] : "";
            if (slanted) names_height = fmax(names_height, 0.55 * text_width(name, TICK_SIZE));
            output_print(f, "<text class=\"tick\" text-anchor=\"%s\" transform=\"translate(%.1f %.1f)%s\">", slanted ? "end" : "middle",
                         px(a, (double)i) + (slanted ? 5.0 : 0.0), base + (slanted ? 14.0 : 20.0), slanted ? " rotate(-33)" : "");
            escaped(f, name);
            output_print(f, "</text>\n");
        }
    } else {
        n = make_ticks(&a->x, ticks_along(at->width, 78.0), ticks, &exponent);
        double free_from = -HUGE_VAL;
        for (int i = 0; i < n; i++) {
            double x = px(a, ticks[i].at), half = 0.29 * TICK_SIZE * ticks[i].letters;
            if (!ticks[i].major || x - half < free_from) continue;
            free_from = x + half + 5.0;
            output_print(
                f, "<path class=\"mark\" d=\"M%.2f %.1fv5\"/><text x=\"%.2f\" y=\"%.1f\" text-anchor=\"middle\" class=\"tick\">%s</text>\n",
                x, base, x, base + 21.0, ticks[i].text);
        }
        if (exponent)
            output_print(f,
                         "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\" class=\"tick\">\xC3\x97"
                         "10<tspan class=\"up\" dy=\"-6\">%s%d</tspan></text>\n",
                         at->x + at->width + 14.0, base + 40.0, exponent < 0 ? "\xE2\x88\x92" : "", abs(exponent));
    }
    n = make_ticks(&a->y, ticks_along(at->height, 48.0), ticks, &exponent);
    double widest = 0.0, free_below = HUGE_VAL;
    for (int i = 0; i < n; i++) {
        double y = py(a, ticks[i].at);
        if (!ticks[i].major || y > free_below) continue;
        free_below = y - TICK_SIZE - 1.0;
        widest = fmax(widest, 0.58 * TICK_SIZE * ticks[i].letters);
        output_print(f,
                     "<path class=\"mark\" d=\"M%.1f %.2fh-5\"/><text x=\"%.1f\" y=\"%.2f\" text-anchor=\"end\" class=\"tick\">%s</text>\n",
                     at->x, y, at->x - 9.0, y + 5.0, ticks[i].text);
    }
    if (exponent)
        output_print(f,
                     "<text x=\"%.1f\" y=\"%.1f\" class=\"tick\">\xC3\x97"
                     "10<tspan class=\"up\" dy=\"-6\">%s%d</tspan></text>\n",
                     at->x - 8.0, at->y - 7.0, exponent < 0 ? "\xE2\x88\x92" : "", abs(exponent));
    text_at(f, at->x + 0.5 * at->width, base + 28.0 + LABEL_SIZE + names_height, "middle", "label", a->x.label);
    if (a->y.label && *a->y.label) {
        output_print(f, "<text transform=\"translate(%.1f %.1f) rotate(-90)\" text-anchor=\"middle\" class=\"label\">",
                     at->x - 14.0 - widest - 8.0, at->y + 0.5 * at->height);
        escaped(f, a->y.label);
        output_print(f, "</text>\n");
    }
    if (a->title) text_at(f, at->x, at->y - 10.0 - (a->legend_above ? LEGEND_ROW : exponent ? 14.0 : 0.0), "start", "title", a->title);
}

static void draw_legend(output *f, const panel *a) {
    const layout *at = &a->at;
    double x = at->legend_x + PAD, y = at->legend_y + PAD / 2.0;
    int entries = 0;
    for (int k = 0; k < a->n; k++) entries += in_legend(&a->all[k]);
    if (!entries) return;
    if (!a->legend_outside && !a->legend_above)
        output_print(f, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" rx=\"4\" fill=\"white\" fill-opacity=\"0.85\"/>\n",
                     at->legend_x, at->legend_y, at->legend_width, at->legend_height);
    for (int k = 0; k < a->n; k++) {
        const series *s = &a->all[k];
        if (!in_legend(s)) continue;
        double middle = y + LEGEND_ROW / 2.0;
        const char *dash = s->flags & PLOT_DASHED ? " stroke-dasharray=\"8 5\"" : s->flags & PLOT_DOTTED ? " stroke-dasharray=\"2 4\"" : "";
        if (s->kind == LINE && !(s->flags & PLOT_NO_LINE))
            output_print(f, "<path d=\"M%.1f %.1fh%d\" stroke=\"%s\" stroke-width=\"%s\" stroke-linecap=\"round\"%s%s/>\n", x, middle,
                         SWATCH, colour_of(s), s->flags & PLOT_THIN ? "1.1" : "2.4", dash,
                         s->flags & PLOT_FAINT ? " stroke-opacity=\"0.35\"" : "");
        if (s->kind == POINTS || s->kind == ERROR_BARS || (s->kind == LINE && s->flags & PLOT_MARKED)) {
            output_print(f, "<g fill=\"%s\">", colour_of(s));
            draw_marker(f, s, x + SWATCH / 2.0, middle, 4.0);
            output_print(f, "</g>");
        }
        if (s->kind == BAND || s->kind == BARS)
            output_print(f, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%d\" height=\"12\" fill=\"%s\"%s/>\n", x, middle - 6.0, SWATCH,
                         colour_of(s), s->kind == BAND ? " fill-opacity=\"0.22\"" : "");
        text_at(f, x + SWATCH + PAD, middle + 5.0, "start", "note", s->label);
        if (a->legend_above) x += entry_width(s);
        else y += LEGEND_ROW;
    }
}

static void draw_panel(output *f, const panel *a, int number) {
    const series *heat = first_of(a, HEAT);
    output_print(f, "<clipPath id=\"c%d\"><rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/></clipPath>\n", number, a->at.x,
                 a->at.y, a->at.width, a->at.height);
    if (!heat) draw_axes(f, a);
    /* markers on the edge are drawn whole, what can leave the panel is cut */
    output_print(f, "<g clip-path=\"url(#c%d)\">\n", number);
    for (int k = 0; k < a->n; k++)
        if (a->all[k].kind != POINTS && a->all[k].kind < TEXT) draw_series(f, a, &a->all[k]);
    output_print(f, "</g>\n");
    draw_frame(f, a);
    for (int k = 0; k < a->n; k++)
        if (a->all[k].kind == POINTS || a->all[k].kind >= TEXT) draw_series(f, a, &a->all[k]);
    if (heat) draw_colour_bar(f, a, heat);
    draw_legend(f, a);
}

static const char style[] =
    "<style>text{font-family:Inter,'Helvetica Neue',Helvetica,Arial,'Liberation Sans','DejaVu Sans',sans-serif;fill:#222}"
    ".tick{font-size:14px;fill:#333}.label{font-size:15px}.title{font-size:16px;font-weight:600}.head{font-weight:600}"
    ".note{font-size:14px;paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}" /* legible on bars */
    ".up{font-size:10px}.grid path{stroke:#dcdcdc;stroke-width:1}"
    ".grid .minor{stroke:#f1f1f1}.frame{fill:none;stroke:#444;stroke-width:1.2}.mark{stroke:#444;stroke-width:1.2}</style>\n";

int plot_write(plot *p, const char *folder, const char *name) {
    if (!p) return -1;
    if (p->failed) {
        plot_free(p);
        return common_fail("%s: out of memory for a figure", name);
    }
    double column_left[6] = {0}, column_right[6] = {0}, row_top[6] = {0}, row_bottom[6] = {0};
    for (int r = 0; r < p->rows; r++)
        for (int c = 0; c < p->columns; c++) {
            panel *a = &p->panels[r * p->columns + c];
            if (!a->used) continue;
            lay_out(p, a);
            column_left[c] = fmax(column_left[c], a->at.left);
            column_right[c] = fmax(column_right[c], a->at.right);
            row_top[r] = fmax(row_top[r], a->at.top);
            row_bottom[r] = fmax(row_bottom[r], a->at.bottom);
        }
    double head = p->title && *p->title ? 38.0 : 4.0, width = 0.0, height = head;
    for (int r = 0; r < p->rows; r++) {
        width = 4.0;
        for (int c = 0; c < p->columns; c++) {
            panel *a = &p->panels[r * p->columns + c];
            double x = width + column_left[c], y = height + row_top[r];
            a->at.x += x;
            a->at.y += y;
            a->at.legend_x += x;
            a->at.legend_y += y;
            width = x + p->width + column_right[c];
        }
        height += row_top[r] + p->height + row_bottom[r] + 6.0;
    }
    width += 6.0;
    /* a title that is too long for the figure gets smaller letters; bold ones are a quarter wider */
    double title_size = 19.0, title_width = p->title ? 1.25 * text_width(p->title, title_size) + 30.0 : 0.0;
    if (title_width > width) title_size = fmax(13.0, title_size * width / title_width);
    width = fmax(width, title_width * title_size / 19.0);
    output *f = output_open(folder, name);
    if (!f) {
        plot_free(p);
        return -1;
    }
    output_print(f, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\">\n", width, height,
                 width, height);
    output_print(f, "%s<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n", style);
    if (p->title) {
        output_print(f, "<text x=\"16\" y=\"27\" class=\"head\" font-size=\"%.1f\">", title_size);
        escaped(f, p->title);
        output_print(f, "</text>\n");
    }
    for (int i = 0; i < p->rows * p->columns; i++)
        if (p->panels[i].used) draw_panel(f, &p->panels[i], i);
    output_print(f, "</svg>\n");
    plot_free(p);
    return output_close(f);
}
