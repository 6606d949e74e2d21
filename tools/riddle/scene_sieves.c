/* scene_sieves.c: see scene_sieves.h */
#include "scene_sieves.h"

#include <math.h>
#include <stdlib.h>

enum { SIEVES_MAX = 400, DECADE = 40 };

/* ISO 565 and ISO 3: rounded numbers of a decade of R40, of which the other series take every 2nd, 3rd,
   4th, 6th or 8th. */
static const double r40[DECADE] = {1.00, 1.06, 1.12, 1.18, 1.25, 1.32, 1.40, 1.50, 1.60, 1.70, 1.80, 1.90, 2.00, 2.12,
                                   2.24, 2.36, 2.50, 2.65, 2.80, 3.00, 3.15, 3.35, 3.55, 3.75, 4.00, 4.25, 4.50, 4.75,
                                   5.00, 5.30, 5.60, 6.00, 6.30, 6.70, 7.10, 7.50, 8.00, 8.50, 9.00, 9.50};
static const int step_of[] = {0, 8, 4, 2, 6, 3}; /* none, R5, R10, R20, R20/3, R40/3 */

/* Sieve number k of R40, counted from 1 mm [m]. Products are of whole numbers, so that 0.2 mm is 0.2e-3. */
static double sieve(int k) {
    const int decade = (int)floor((double)k / DECADE);
    const double hundredths = floor(100.0 * r40[k - decade * DECADE] + 0.5);
    double tens = 1e5;
    for (int n = decade; n < 0; n++) tens *= 10.0;
    for (int n = decade; n > 0; n--) tens /= 10.0;
    return hundredths / tens;
}

static int rising(const void *a, const void *b) {
    const double p = *(const double *)a, q = *(const double *)b;
    return p < q ? -1 : p > q;
}

int scene_make_sieves(scene *s, double smallest, double largest) {
    const measure_def *m = &s->def->measure;
    const tree *at = m->part.where;
    const int step = step_of[m->series];
    if (m->sieves.n == 0 && step == 0) return 0;
    s->sieve = tree_memory(s->file, (size_t)(m->sieves.n + SIEVES_MAX) * sizeof *s->sieve);
    if (!s->sieve) return -1;
    if (m->sieves.n > 0) {
        const double *given = m->sieves.item;
        for (int k = 0; k < m->sieves.n; k++) s->sieve[k] = given[k];
        qsort(s->sieve, (size_t)m->sieves.n, sizeof *s->sieve, rising);
        for (int k = 0; k < m->sieves.n; k++)
            if (k == 0 || s->sieve[k] > s->sieve[k - 1] * (1.0 + 1e-12)) s->sieve[s->sieves++] = s->sieve[k];
        return 0;
    }
    int first = step * (int)floor(DECADE * log10(smallest * 1e3) / step);
    while (sieve(first) > smallest) first -= step;
    while (sieve(first + step) <= smallest) first += step;
    for (int k = first; s->sieves == 0 || s->sieve[s->sieves - 1] < largest; k += step) {
        if (s->sieves == SIEVES_MAX)
            return tree_fail(s->file, fields_where(&m->part, "series"), "series: more than %d sieves", SIEVES_MAX);
        s->sieve[s->sieves++] = sieve(k);
    }
    if (s->sieve[s->sieves - 1] == largest) { /* single particles of that size stay on it */
        s->sieve[s->sieves] = sieve(first + step * s->sieves);
        s->sieves++;
    }
    tree_note(s->file, at, "series: %d sieves from %g to %g mm", s->sieves, 1e3 * s->sieve[0],
              1e3 * s->sieve[s->sieves - 1]);
    return 0;
}

int scene_sieve_class(const scene *s, double diameter, double *low, double *high) {
    int k = 0;
    while (k < s->sieves && s->sieve[k] <= diameter) k++;
    *low = k > 0 ? s->sieve[k - 1] : 0.0, *high = k < s->sieves ? s->sieve[k] : HUGE_VAL;
    return k;
}

/* Share of a normal distribution between 0 and z > 0: erf's series, whose terms are all positive. */
static double normal_to(double z) {
    double term = z, sum = z;
    if (z > 9.0) return 0.5;
    for (int n = 1; n < 400 && term > 1e-18 * sum; n++) term *= z * z / (2.0 * n + 1.0), sum += term;
    return sum * riddle_exp(-0.5 * z * z) * 0.3989422804014327;
}
static double normal_between(double a, double b) {
    if (a >= 0.0) return normal_to(b) - normal_to(a);
    return b <= 0.0 ? normal_to(-a) - normal_to(-b) : normal_to(-a) + normal_to(b);
}

/* Not yet over that of the whole. */
static double part_between(const dem_sizes *z, double from, double to) {
    if (z->kind == DEM_SIZES_UNIFORM) return to - from;
    const double a = riddle_log(from / z->scale), b = riddle_log(to / z->scale);
    if (z->kind == DEM_SIZES_LOGNORMAL) return normal_between(a / z->spread, b / z->spread);
    return riddle_exp(-riddle_exp(z->spread * a)) - riddle_exp(-riddle_exp(z->spread * b));
}

double scene_share_between(const dem_sizes *z, double from, double to) {
    const double a = fmax(from, z->smallest), b = fmin(to, z->largest);
    if (z->smallest == z->largest) return from <= z->smallest && z->smallest < to ? 1.0 : 0.0;
    return b > a ? part_between(z, a, b) / part_between(z, z->smallest, z->largest) : 0.0;
}
