/* letters.h: text in pictures of pixels: DejaVu Sans, drawn with smooth edges at any size.

       // x, y: left end of the line that the letters stand on [pixels]; size: of a capital
       letters_draw(&to, x, y, size, "t = 0.5 s");
       letters_width("t = 0.5 s", size);                // [pixels]

   Text is UTF-8: ASCII, Latin-1, Greek and a few signs of mathematics; what else there is shows as a space. For
   render.c alone. */
#ifndef LETTERS_H
#define LETTERS_H

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "letters_data.h"
#include "utf8.h"

/* Where text goes: put(user, x, y, share) blends one pixel; share 0 .. 1 is how much of it the letter covers. */
typedef struct letters_target {
    void (*put)(void *user, int x, int y, double share);
    void *user;
} letters_target;

/* A letter's box of pixels, each with the share that the outline covers (negative for one that runs the other way). */
typedef struct letters_box {
    int width, height;
    double *cover;
} letters_box;

/* The next character of a text; 0 for a byte that begins none. */
static unsigned letters_next(const char **text) {
    uint32_t code = 0;
    const size_t n = utf8_get((const unsigned char *)*text, 4, &code);
    *text += n ? n : 1;
    return n ? code : 0;
}

/* Row of the table; that of the space for what the font has not. */
static int letters_find(unsigned code) {
    int low = 0, high = (int)(sizeof letters_table / sizeof *letters_table) - 1;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (letters_table[middle].code < code) low = middle + 1;
        else high = middle;
    }
    return letters_table[low].code == code ? low : 0;
}

/* The area left of x and right of an edge of unit height that runs from `left` over `span`. */
static double letters_area(double x, double left, double span) {
    const double way = x - left;
    return way <= 0.0 ? 0.0 : way < span ? 0.5 * way * way / span : way - 0.5 * span;
}

/* Adds what lies right of an edge from (x0, y0) to (x1, y1), in pixels from the box's upper left corner: over a closed
   contour the parts outside cancel. */
static void letters_edge(letters_box *b, double x0, double y0, double x1, double y1) {
    const double low = fmin(y0, y1), high = fmax(y0, y1);
    for (int row = (int)low; row < b->height && row < high; row++) {
        const double from = fmax(low, row), to = fmin(high, row + 1.0);
        if (!(from < to)) continue;
        const double xa = x0 + (x1 - x0) * (from - y0) / (y1 - y0), xb = x0 + (x1 - x0) * (to - y0) / (y1 - y0);
        const double left = fmin(xa, xb), span = fabs(xb - xa), tall = y0 < y1 ? to - from : from - to;
        for (int i = (int)left; i < b->width; i++)
            b->cover[(size_t)row * (size_t)b->width + (size_t)i] +=
                tall * (letters_area(i + 1.0, left, span) - letters_area(i, left, span));
    }
}

typedef struct letters_point {
    double x, y;
    int on;
} letters_point;

enum { LETTERS_POINTS = 200, LETTERS_PARTS = 8 }; /* points of a contour; straight parts of a curve */

/* Reads the next contour of an outline, in pixels from (x, y); 0: none is left. */
static int letters_contour(const char **outline, letters_point *to, double x, double y, double scale) {
    int n = 0;
    if (**outline != ' ') return 0;
    for (*outline += 1; **outline && **outline != ' '; *outline += 4) {
        int d[4];
        for (int k = 0; k < 4; k++) d[k] = (int)(strchr(letters_digits, (*outline)[k]) - letters_digits);
        const int across = LETTERS_BASE * d[0] + d[1], up = LETTERS_BASE * d[2] + d[3];
        if (n == LETTERS_POINTS) continue;
        to[n].x = x + scale * (across / 2 - LETTERS_SHIFT), to[n].y = y - scale * (up - LETTERS_SHIFT),
        to[n++].on = across % 2;
    }
    return n;
}

static letters_point letters_between(letters_point a, letters_point b) {
    const letters_point middle = {0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 1};
    return middle;
}

/* Between two points off a quadratic spline lies one on it. */
static void letters_fill(letters_box *b, const letters_point *p, int n) {
    letters_point at = p[0].on ? p[0] : p[n - 1].on ? p[n - 1] : letters_between(p[0], p[n - 1]);
    for (int k = p[0].on ? 1 : 0, end = k + n; k < end; k++) {
        const letters_point c = p[k % n], next = p[(k + 1) % n];
        const letters_point to = c.on ? c : next.on ? next : letters_between(c, next);
        const int parts = c.on ? 1 : LETTERS_PARTS;
        letters_point last = at;
        for (int q = 1; q <= parts; q++) {
            const double t = (double)q / parts, s = 1.0 - t;
            letters_point here = to;
            if (!c.on)
                here.x = s * s * at.x + 2.0 * s * t * c.x + t * t * to.x,
                here.y = s * s * at.y + 2.0 * s * t * c.y + t * t * to.y;
            letters_edge(b, last.x, last.y, here.x, here.y);
            last = here;
        }
        at = to;
    }
}

/* Draws one letter; without memory for its box it is left out. */
static void letters_one(const letters_target *to, double x, double y, double scale, const char *outline) {
    letters_point p[LETTERS_POINTS];
    double low_x = HUGE_VAL, high_x = -HUGE_VAL, low_y = HUGE_VAL, high_y = -HUGE_VAL;
    int n;
    for (const char *rest = outline; (n = letters_contour(&rest, p, x, y, scale)) > 0;)
        for (int k = 0; k < n; k++) {
            low_x = fmin(low_x, p[k].x), high_x = fmax(high_x, p[k].x);
            low_y = fmin(low_y, p[k].y), high_y = fmax(high_y, p[k].y);
        }
    if (!(low_x < high_x) || !(high_x - low_x < 4096.0) || !(high_y - low_y < 4096.0) || fabs(low_x) > 1e6 ||
        fabs(low_y) > 1e6)
        return;
    const int left = (int)floor(low_x), top = (int)floor(low_y);
    letters_box b = {(int)ceil(high_x) - left + 1, (int)ceil(high_y) - top + 1, NULL};
    b.cover = calloc((size_t)b.width * (size_t)b.height, sizeof *b.cover);
    if (!b.cover) return;
    for (const char *rest = outline; (n = letters_contour(&rest, p, x - left, y - top, scale)) > 0;)
        letters_fill(&b, p, n);
    for (int j = 0; j < b.height; j++)
        for (int i = 0; i < b.width; i++) {
            const double share = fmin(fabs(b.cover[(size_t)j * (size_t)b.width + (size_t)i]), 1.0);
            if (share > 1e-3) to->put(to->user, left + i, top + j, share);
        }
    free(b.cover);
}

/* Width of a text [pixels]; `to` NULL: nothing is drawn. */
static double letters_draw(const letters_target *to, double x, double y, double size, const char *text) {
    const double scale = size / LETTERS_CAPITAL;
    double at = x;
    while (*text) {
        const int row = letters_find(letters_next(&text));
        if (to) letters_one(to, at, y, scale, letters_table[row].outline);
        at += scale * letters_table[row].advance;
    }
    return at - x;
}

static double letters_width(const char *text, double size) { return letters_draw(NULL, 0.0, 0.0, size, text); }

#endif
