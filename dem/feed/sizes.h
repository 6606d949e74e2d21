/* Size distributions: pure functions, and the checks of a source. */
#pragma once
#include "../regions/regions.h"

/* Draws a number from [0, 1) by splitmix64. */
static inline double dem__uniform(uint64_t *random) {
    uint64_t z = *random += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static inline dem_sizes dem__sizes(dem_size_kind kind, double scale, double spread, double smallest, double largest,
                                   int by_mass) {
    dem_sizes s;
    memset(&s, 0, sizeof s);
    s.kind = kind;
    s.by_mass = by_mass != 0;
    s.scale = scale;
    s.spread = spread;
    s.smallest = smallest;
    s.largest = largest;
    return s;
}
DEM_API dem_sizes dem_one_size(double diameter) {
    const double share = 1.0;
    return dem_size_list(1, &diameter, &share, 0);
}
DEM_API dem_sizes dem_size_list(int n, const double *diameter, const double *share, int by_mass) {
    dem_sizes s = dem__sizes(DEM_SIZES_LIST, 0.0, 0.0, 0.0, 0.0, by_mass);
    s.count = n;
    for (int k = 0; diameter && share && k < n && k < DEM_SIZES_MAX; k++)
        s.diameter[k] = diameter[k], s.share[k] = share[k];
    return s;
}
DEM_API dem_sizes dem_uniform_sizes(double smallest, double largest, int by_mass) {
    return dem__sizes(DEM_SIZES_UNIFORM, 0.0, 0.0, smallest, largest, by_mass);
}
DEM_API dem_sizes dem_lognormal_sizes(double median, double spread, double smallest, double largest, int by_mass) {
    return dem__sizes(DEM_SIZES_LOGNORMAL, median, spread, smallest, largest, by_mass);
}
DEM_API dem_sizes dem_rosin_rammler_sizes(double scale, double exponent, double smallest, double largest, int by_mass) {
    return dem__sizes(DEM_SIZES_ROSIN_RAMMLER, scale, exponent, smallest, largest, by_mass);
}

/* Returns the logarithm of the share per ln d at d = scale e^y, up to a constant. It is concave in y for every
   distribution. */
static inline double dem__log_share(const dem_sizes *s, double y) {
    if (s->kind == DEM_SIZES_LOGNORMAL) return -0.5 * y * y / (s->spread * s->spread);
    return s->kind == DEM_SIZES_ROSIN_RAMMLER ? s->spread * y - riddle_exp(s->spread * y) : y;
}
/* Returns the same for the number of spheres. */
static inline double dem__log_number(const dem_sizes *s, double y) {
    const double f = dem__log_share(s, y);
    return s->by_mass ? f - 3.0 * y : f;
}

/* Returns an end of the interval of ln d: the cut-off or, if that is closer to the peak, where the density is e^-60 of
   that at the peak. Nothing is drawn beyond it, and the rest is cut into pieces so fine that one draw in ten is
   accepted. */
static inline double dem__tail(const dem_sizes *s, double end, double peak) {
    const double least = dem__log_number(s, peak) - 60.0;
    double inside = peak;
    if (!(dem__log_number(s, end) < least)) return end;
    for (int k = 0; k < 60; k++) {
        const double middle = 0.5 * (end + inside);
        if (dem__log_number(s, middle) < least) end = middle;
        else inside = middle;
    }
    return end;
}

/* Returns whether a size distribution is valid. smallest, largest: its diameters. */
static inline int dem__are_sizes(const dem_sizes *s, double *smallest, double *largest) {
    *smallest = s->smallest, *largest = s->largest;
    if (s->kind == DEM_SIZES_LIST) {
        double sum = 0.0;
        if (s->count < 1 || s->count > DEM_SIZES_MAX) return 0;
        *smallest = *largest = s->diameter[0];
        for (int k = 0; k < s->count; k++) {
            if (!dem__positive(s->diameter[k]) || !dem__not_negative(s->share[k])) return 0;
            sum += s->share[k];
            *smallest = s->diameter[k] < *smallest ? s->diameter[k] : *smallest;
            *largest = s->diameter[k] > *largest ? s->diameter[k] : *largest;
        }
        return dem__positive(sum) && *largest <= 1e6 * *smallest;
    }
    if (!dem__positive(s->smallest) || !(s->largest >= s->smallest && s->largest <= 1e6 * s->smallest) ||
        !dem__finite(s->largest))
        return 0;
    if (s->kind == DEM_SIZES_UNIFORM) return 1;
    if (!dem__positive(s->scale)) return 0;
    if (s->kind == DEM_SIZES_LOGNORMAL
            ? !(s->spread >= 1e-3 && s->spread <= 5.0)
            : s->kind != DEM_SIZES_ROSIN_RAMMLER || !(s->spread >= 0.1 && s->spread <= 100.0))
        return 0;
    /* the largest density between the cut-offs is at least 1e-20 of that at the peak, which is at the scale; otherwise
       a unit is wrong */
    const double nearest = riddle_log(dem__clamp(s->scale, s->smallest, s->largest) / s->scale);
    return dem__log_share(s, nearest) - dem__log_share(s, 0.0) > -46.0;
}

/* Draws a diameter by rejection. The interval of ln d is cut into pieces, each bounded by the largest density in it.
   The position of the peak is known in closed form. */
static inline double dem__draw_continuous(const dem_sizes *s, uint64_t *random) {
    enum { PIECES = 32, TRIES = 10000 };
    const double scale = s->kind == DEM_SIZES_UNIFORM ? s->largest : s->scale, lost = s->by_mass ? 3.0 : 0.0;
    double low = riddle_log(s->smallest / scale), high = riddle_log(s->largest / scale);
    double peak = s->by_mass ? -HUGE_VAL : HUGE_VAL, bound[PIECES], total = 0.0;
    if (s->kind == DEM_SIZES_LOGNORMAL) peak = -lost * s->spread * s->spread;
    if (s->kind == DEM_SIZES_ROSIN_RAMMLER)
        peak = s->spread > lost ? riddle_log1p(-lost / s->spread) / s->spread : -HUGE_VAL;
    peak = dem__clamp(peak, low, high);
    low = dem__tail(s, low, peak), high = dem__tail(s, high, peak);
    const double width = (high - low) / (double)PIECES, top = dem__log_number(s, peak);
    for (int k = 0; k < PIECES; k++) {
        bound[k] = riddle_exp(dem__log_number(s, dem__clamp(peak, low + k * width, low + (k + 1) * width)) - top);
        total += bound[k];
    }
    for (int tries = 0; tries < TRIES; tries++) {
        double place = total * dem__uniform(random);
        int k = 0;
        while (k < PIECES - 1 && place >= bound[k]) place -= bound[k++];
        const double y = low + (k + dem__uniform(random)) * width;
        if (dem__uniform(random) * bound[k] < riddle_exp(dem__log_number(s, y) - top))
            return dem__clamp(scale * riddle_exp(y), s->smallest, s->largest);
    }
    return (double)NAN; /* with a probability below 1e-400 */
}

DEM_API double dem_draw_size(const dem_sizes *sizes, uint64_t *random) {
    double smallest, largest, weight[DEM_SIZES_MAX], sum = 0.0;
    const dem_sizes *s = sizes;
    if (!s || !random || !dem__are_sizes(s, &smallest, &largest)) return (double)NAN;
    if (s->kind != DEM_SIZES_LIST) return dem__draw_continuous(s, random);
    for (int k = 0; k < s->count; k++) {
        const double ratio = smallest / s->diameter[k];
        weight[k] = s->by_mass ? s->share[k] * ratio * ratio * ratio : s->share[k];
        sum += weight[k];
    }
    double place = sum * dem__uniform(random);
    int k = 0;
    while (k < s->count - 1 && place >= weight[k]) place -= weight[k++];
    while (k > 0 && weight[k] == 0.0) k--; /* rounding of the sum may lead past the last diameter that has a share */
    return s->diameter[k];
}

DEM_API dem_feed dem_default_feed(void) {
    dem_feed feed;
    memset(&feed, 0, sizeof feed);
    feed.region = dem_box_region(dem_vec3(0.0, 0.0, 0.0), dem_vec3(0.1, 0.1, 0.1));
    feed.sizes = dem_one_size(1e-3);
    feed.tries = 1000;
    feed.random = 1;
    return feed;
}
