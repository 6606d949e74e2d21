/* Ranks: the order of particles in space. Contacts lie in memory in this order, so that what is computed together lies
   close together, and threads share few particles. Reads positions; writes ranks. Particles keep their numbers.
   Promises: the order of the particles present depends only on the history of the scene. */
#pragma once
#include "particles.h"
#include "../base/parallel.h"

/* Returns the lower of the ranks of a contact's particles, by which contacts are sorted. */
DEM_INLINE int32_t dem__lower_rank(const dem_world *w, int32_t i, int32_t j) {
    const int32_t *rank = w->engine->bodies.rank;
    return j < 0 || rank[i] < rank[j] ? rank[i] : rank[j];
}

/* Returns the position of a cell on Hilbert's curve through 1024 x 1024 x 1024 cells (Skilling 2004). Successive cells
   on the curve are neighbours. */
static inline uint32_t dem__curve_place(uint32_t x, uint32_t y, uint32_t z) {
    uint32_t at[3] = {x, y, z}, flip = 0, place = 0;
    for (uint32_t bit = 512; bit > 1; bit >>= 1) {
        const uint32_t low = bit - 1;
        for (int a = 0; a < 3; a++) {
            const uint32_t swap = at[a] & bit ? 0 : (at[0] ^ at[a]) & low;
            at[0] ^= at[a] & bit ? low : swap;
            at[a] ^= swap;
        }
    }
    at[1] ^= at[0], at[2] ^= at[1];
    for (uint32_t bit = 512; bit > 1; bit >>= 1) flip ^= at[2] & bit ? bit - 1 : 0;
    for (int a = 0; a < 3; a++) at[a] ^= flip;
    for (int bit = 9; bit >= 0; bit--) {
        for (int a = 0; a < 3; a++) place = place << 1 | (at[a] >> bit & 1u);
    }
    return place;
}

/* The cube in which most particles lie: its lower corner [m], and cells per metre. */
typedef struct dem__curve_box {
    dem_vec low;
    double per_metre;
} dem__curve_box;

/* Makes the cube span four standard deviations each way from the mean, within the particles' range. The few particles
   outside go into the cells at the border. */
static inline dem__curve_box dem__curve_of(const dem_world *w, const int32_t *by_number) {
    double low[3], high[3], sum[3] = {0.0, 0.0, 0.0}, square[3] = {0.0, 0.0, 0.0}, n = 0.0, longest = 0.0;
    dem__curve_box box;
    for (int a = 0; a < 3; a++) low[a] = HUGE_VAL, high[a] = -HUGE_VAL;
    for (ptrdiff_t k = 0; k < w->count; k++) {
        const ptrdiff_t i = by_number ? by_number[k] : k;
        if (!w->alive[i]) continue;
        const dem_vec x = dem__at(w, i, dem__now(w, i));
        n += 1.0;
        for (int a = 0; a < 3; a++) {
            const double v = dem_axis(x, a);
            low[a] = v < low[a] ? v : low[a], high[a] = v > high[a] ? v : high[a];
            sum[a] += v, square[a] += v * v;
        }
    }
    for (int a = 0; a < 3; a++) {
        const double mean = sum[a] / n, variance = square[a] / n - mean * mean,
                     reach = variance > 0.0 ? 4.0 * sqrt(variance) : 0.0,
                     from = low[a] > mean - reach ? low[a] : mean - reach,
                     to = high[a] < mean + reach ? high[a] : mean + reach;
        *dem_axis_of(&box.low, a) = from;
        longest = to - from > longest ? to - from : longest;
    }
    box.per_metre = longest > 0.0 ? 1024.0 / longest : 0.0;
    return box;
}

/* Returns the cell of a coordinate; the first cell for NaN. */
DEM_INLINE uint32_t dem__curve_cell(double x, double low, double per_metre) {
    const double at = (x - low) * per_metre;
    return at > 0.0 ? (at < 1023.0 ? (uint32_t)at : 1023u) : 0u;
}

/* Writes the positions of particles first .. end-1 on the curve to pairs.cell_of, which only a rebuild uses. */
static inline void dem__place_on_curve(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__curve_box *box = (const dem__curve_box *)context;
    (void)part;
    for (ptrdiff_t i = first; i < end; i++) {
        const dem_vec x = dem__at(w, i, dem__now(w, i));
        w->engine->pairs.cell_of[i] = (int32_t)dem__curve_place(dem__curve_cell(x.x, box->low.x, box->per_metre),
                                                                dem__curve_cell(x.y, box->low.y, box->per_metre),
                                                                dem__curve_cell(x.z, box->low.z, box->per_metre));
    }
}

/* Sorts particles by ten bits of their position on the curve, from bit `shift` on. Those with the same bits keep their
   order. from: NULL for the order of numbers. */
static inline void dem__sort_by_place(const int32_t *place, int shift, ptrdiff_t n, const int32_t *from, int32_t *to) {
    int32_t start[1024];
    memset(start, 0, sizeof start);
    for (ptrdiff_t k = 0; k < n; k++) start[place[k] >> shift & 1023]++;
    for (int32_t q = 0, sum = 0; q < 1024; q++) {
        const int32_t of = start[q];
        start[q] = sum;
        sum += of;
    }
    for (ptrdiff_t k = 0; k < n; k++) {
        const int32_t i = from ? from[k] : (int32_t)k;
        to[start[place[i] >> shift & 1023]++] = i;
    }
}

static inline void dem__set_ranks(dem_world *w) {
    dem__bodies *bodies = &w->engine->bodies;
    for (ptrdiff_t r = 0; r < w->count; r++) bodies->rank[bodies->by_rank[r]] = (int32_t)r;
}

/* Renews the ranks of all particles. */
static DEM__NOINLINE void dem__renew_ranks(dem_world *w) {
    dem__bodies *bodies = &w->engine->bodies;
    const int32_t *place = w->engine->pairs.cell_of;
    int32_t *other = w->engine->scratch.index;
    /* sums, and particles of one cell, follow the order of numbers */
    const int32_t *by_number = bodies->by_place ? other : NULL;
    for (ptrdiff_t i = 0; i < w->count && by_number; i++) other[bodies->given[i]] = (int32_t)i;
    dem__curve_box box = dem__curve_of(w, by_number);
    dem__in_parts(w, dem__parts(w, 4 * w->count), w->count, dem__place_on_curve, &box);
    dem__sort_by_place(place, 0, w->count, by_number, bodies->by_rank);
    dem__sort_by_place(place, 10, w->count, bodies->by_rank, other);
    dem__sort_by_place(place, 20, w->count, other, bodies->by_rank);
    dem__set_ranks(w);
}
