/* Cells: one grid for each size class of spheres. Reads positions; keeps nothing. */
#pragma once
#include "../base/api.h"

/* The grid of one size class: spheres up to DEM__CLASS times as large as its smallest. */
typedef struct dem__grid {
    double low[3], inverse[3]; /* lower corner [m]; 1 / cell size [1/m] */
    double widest;             /* radius of the largest sphere [m] */
    int32_t n[3], wraps[3];
    ptrdiff_t count, first; /* number of spheres; where its first cell is in the common list */
} dem__grid;

#define DEM__CLASS 2.5         /* any value from 2 to 3 takes the same time: a larger one means fewer levels, but more
                                  spheres in a cell */
enum { DEM__LEVELS_MAX = 16 }; /* the last level takes all spheres more than 2.5^15 times as large as the smallest */

/* Returns the number of a sphere's size class. */
DEM_INLINE int dem__level(double radius, double smallest) {
    int level = 0;
    for (double bound = DEM__CLASS * smallest; radius >= bound && level < DEM__LEVELS_MAX - 1; level++)
        bound *= DEM__CLASS;
    return level;
}

/* Finds the range along an axis in which most points lie: four standard deviations each way from the mean, repeated for
   the points in that range as long as this halves its length. The few points outside go into the cells at the border.
   Otherwise one particle far away would make all cells large. */
static inline void dem__bulk(const dem_vec *point, int axis, ptrdiff_t n, double *low, double *high) {
    double from = HUGE_VAL, to = -HUGE_VAL, span;
    for (ptrdiff_t i = 0; i < n; i++) {
        const double v = dem_axis(point[i], axis);
        from = v < from ? v : from;
        to = v > to ? v : to;
    }
    do {
        double sum = 0.0, square = 0.0, inside = 0.0;
        span = to - from;
        for (ptrdiff_t i = 0; i < n; i++) {
            const double v = dem_axis(point[i], axis), d = v - from;
            if (!(v >= from && v <= to)) continue;
            sum += d, square += d * d, inside += 1.0;
        }
        const double mean = sum / inside, variance = square / inside - mean * mean,
                     reach = variance > 0.0 ? 4.0 * sqrt(variance) : 0.0;
        to = mean + reach < span ? from + (mean + reach) : to;
        from = mean - reach > 0.0 ? from + (mean - reach) : from;
    } while (to > from && to - from < 0.5 * span);
    *low = from, *high = to;
}

/* Divides a box into cells no smaller than `size`, at most four for each sphere. */
static inline void dem__make_grid(const dem_world *w, dem__grid *g, double size, dem_vec low, dem_vec high) {
    double span[3];
    for (int a = 0; a < 3; a++) {
        g->wraps[a] = w->def.periodic[a];
        g->low[a] = dem_axis(g->wraps[a] ? w->def.low : low, a);
        span[a] = dem_axis(g->wraps[a] ? w->def.high : high, a) - g->low[a];
    }
    for (;; size *= 1.26) {
        double cells = 1.0;
        for (int a = 0; a < 3; a++) cells *= floor(span[a] / size) + 1.0;
        if (!(cells > 4.0 * (double)g->count + 64.0)) break; /* NaN: an infinite span has one cell */
    }
    for (int a = 0; a < 3; a++) {
        const double n = floor(span[a] / size);
        g->n[a] = n > 1.0 ? (int32_t)n : 1; /* periodic: a whole number of cells, each a little larger */
        g->inverse[a] = g->wraps[a] ? g->n[a] / span[a] : 1.0 / size;
        if (!g->wraps[a]) g->n[a]++;
    }
}

/* Finds the cells along an axis that [v - reach, v + reach] overlaps, each at most once. Returns how many. first: the
   first of them; the caller counts on from it and wraps. */
DEM_INLINE int32_t dem__cells(const dem__grid *g, int a, double v, double reach, int32_t *first) {
    const double from = (v - reach - g->low[a]) * g->inverse[a], to = (v + reach - g->low[a]) * g->inverse[a],
                 last = (double)(g->n[a] - 1);
    if (g->wraps[a]) {
        const double low = floor(from), high = floor(to);
        *first = 0;
        if (!(high - low < last)) return g->n[a];
        *first = (int32_t)low; /* v is in the box, or at its upper end */
        *first += *first < 0 ? g->n[a] : (*first >= g->n[a] ? -g->n[a] : 0);
        return (int32_t)(high - low) + 1;
    }
    *first = (int32_t)(from > 0.0 ? (from < last ? from : last) : 0.0);
    return (int32_t)(to > 0.0 ? (to < last ? to : last) : 0.0) - *first + 1;
}

DEM_INLINE ptrdiff_t dem__cell(const dem__grid *g, dem_vec at) {
    int32_t cx, cy, cz;
    dem__cells(g, 0, at.x, 0.0, &cx), dem__cells(g, 1, at.y, 0.0, &cy), dem__cells(g, 2, at.z, 0.0, &cz);
    return g->first + ((ptrdiff_t)cz * g->n[1] + cy) * g->n[0] + cx;
}
