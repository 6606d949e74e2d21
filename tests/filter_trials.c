/* Trials of filtration_evaluate: how often the ranges that it states hold what the readings were made from, over
   numbers of readings, spacings and kinds of scatter, with the defaults and nothing else given. scripts/verify
   filter_ranges builds and runs it; prints a table; leaves with 1 where a range holds outside of the limits.
     filter_trials [TRIALS] [SEED] [CSV]     trials of each kind with even volumes (2000),
     a fifth as many for each other spacing; the table as a file */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "filtration.h"
#include "../examples/common/random.h"

static uint64_t stream = 1;
static double uniform(void) { return random_inner(&stream); }
static double normal(void) { return sqrt(-2.0 * log(uniform())) * cos(6.283185307179586 * uniform()); }

enum { LARGEST = 200, KINDS = 9 };
static const char *const kinds[KINDS] = {"equal t/V",      "time",          "volume",
                                         "proportional",   "time, AR 0.6",  "t/V, AR 0.6",
                                         "volume, AR 0.6", "balance walks", "balance drifts"};

/* How the volumes lie: even steps (every other trial: of time); each twice the one before; 1, 2, 5, 10 ...; at
   random, as likely in each decade. The last three span a factor of 1000 at most. */
enum { EVEN, EQUAL_TIMES, DOUBLING, ONE_TWO_FIVE, RANDOM, SPACINGS };
static const char *const spacings[SPACINGS] = {"even", "equal times", "doubling", "1-2-5", "random"};

static const double slope = 5.175e8, end_volume = 14e-6; /* [s/m6], [m3] */

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Volumes without scatter. */
static void place(int spacing, size_t n, double intercept, double *V) {
    static const double of_decade[] = {1.0, 0.5, 0.2};
    const double end = (slope * end_volume + intercept) * end_volume, steps = (double)n - 1.0;
    for (size_t i = 0; i < n; i++) {
        const double share = (double)(i + 1) / (double)n, back = (double)(n - 1 - i);
        switch (spacing) {
        case EVEN: V[i] = share * end_volume; break;
        case EQUAL_TIMES: V[i] = filtration_volume_of_time(slope, intercept, share * end); break;
        case DOUBLING: V[i] = end_volume * pow(2.0, -back * fmin(1.0, 10.0 / steps)); break;
        case ONE_TWO_FIVE:
            V[i] = n > 10 ? end_volume * pow(1000.0, -back / steps)
                          : end_volume * of_decade[(n - 1 - i) % 3] * pow(0.1, (double)((n - 1 - i) / 3));
            break;
        default: V[i] = end_volume * pow(n > 5 ? 100.0 : 30.0, -uniform()); break;
        }
    }
    if (spacing == RANDOM) qsort(V, n, sizeof *V, by_size);
}

/* Readings of one test: scatter of `size` of the last time or volume. */
static void draw(int kind, size_t n, double intercept, int spacing, double size, double *t, double *V) {
    const double end = (slope * end_volume + intercept) * end_volume, rough = kind >= 4 && kind <= 6 ? 0.6 : 0.0,
                 drift = 3.0 * normal();
    double error = normal(), walk = 0.0, before = 0.0;
    place(spacing, n, intercept, V);
    for (size_t i = 0; i < n; i++) {
        const double v = V[i], time = (slope * v + intercept) * v;
        error = rough * error + sqrt(1.0 - rough * rough) * normal();
        walk += normal() * sqrt(1.0 / (double)n);
        t[i] = time, V[i] = v;
        switch (kind) {
        case 0:
        case 5: t[i] += size * end * v / end_volume * error; break;
        case 1:
        case 4: t[i] += size * end * error; break;
        case 3: t[i] *= 1.0 + size * error; break;
        case 2:
        case 6: V[i] += size * end_volume * error; break;
        case 7: V[i] += size * end_volume * (0.3 * error + 2.0 * walk); break;
        default: V[i] += size * end_volume * (0.5 * error + drift * time / end); break;
        }
        if (V[i] < 0.0) V[i] = 0.0;
        if (t[i] < before) t[i] = before;
        before = t[i];
    }
}

/* What is known of the scatter: nothing, that errors are independent, the size of the drift. */
typedef struct knowledge {
    const char *name;
    int first, last; /* kinds */
    int independent, drift;
} knowledge;

/* The least share of ranges that must hold. */
static double least_of(const knowledge *known, int kind, int spacing, size_t n) {
    if (spacing > EQUAL_TIMES) { /* over decades of volume a few readings tell less of the scatter */
        if (kind == 7) return 62.0;
        if (kind >= 4 && kind <= 6) return 84.0;
        /* an error of the clock is as large as the first times: they are cut off at 0 */
        if (kind == 1 || kind == 2) return known->independent ? spacing == RANDOM ? 84.0 : 89.0 : 91.0;
        return known->independent ? 90.0 : 93.0;
    }
    if (known->independent) /* Four laws of scatter are weighed, and few readings do not tell them. */
        return kind == 3 && n < 30 ? 89.0 : 91.0;
    /* Fewer readings see no walk of a balance; the ranges widen, but not far enough. */
    if (kind == 7) return n > 100 ? 92.0 : 84.0;
    if (kind >= 4 && kind <= 6) return n > 20 ? 92.0 : 90.0;
    return 93.0;
}
/* The most: where nothing is known the ranges allow for a drift, and are too wide where there is none. */
static double most_of(const knowledge *known) { return known->independent ? 99.2 : 100.0; }

static FILE *csv;

static int trials_of(const knowledge *known, int kind, int spacing, size_t n, int trials) {
    static const double intercepts[] = {1700.0, 300.0, 8000.0};
    int given = 0, refused = 0, hits[5] = {0, 0, 0, 0, 0}, bad = 0;
    double width = 0.0, square = 0.0;
    for (int trial = 0; trial < trials; trial++) {
        double t[LARGEST], V[LARGEST];
        const double intercept = intercepts[trial % 3], size = n > 50                                   ? 0.001
                                                               : spacing > EQUAL_TIMES && kind % 3 == 0 ? 0.01
                                                                                                        : 0.004;
        draw(kind, n, intercept, spacing == EVEN ? trial / 3 % 2 : spacing, size, t, V);
        filtration_curve_def def = filtration_curve_default_def();
        filtration_curve c;
        def.independent = known->independent;
        if (known->drift) def.drift_error = 3.0 * size * end_volume;
        if (filtration_evaluate(&def, n, t, V, &c) != FILTRATION_OK) {
            if (spacing != EVEN) { /* an error of the clock leaves fewer than three of the smallest readings */
                refused++;
                continue;
            }
            printf("refused\n");
            return 1;
        }
        if (!(c.slope.low <= c.slope.high)) continue;
        given++;
        hits[0] += c.slope.low <= slope && slope <= c.slope.high;
        hits[1] += c.intercept.low <= intercept && intercept <= c.intercept.high;
        for (int at = 0; at < 3; at++) {
            const double v = end_volume * (at == 0 ? 0.5 : at), time = (slope * v + intercept) * v;
            filtration_estimate e;
            if (filtration_predict(&c, def.pressure, def.area, 0.0, v, &e) == FILTRATION_OK)
                hits[2 + at] += e.low <= time && time <= e.high;
        }
        width += 0.5 * (c.slope.high - c.slope.low) / slope;
        square += (c.slope.value / slope - 1.0) * (c.slope.value / slope - 1.0);
    }
    printf("%-12s %-14s %-12s %4zu %5.1f |", known->name, kinds[kind], spacings[spacing], n,
           100.0 * given / (trials - refused));
    if (csv)
        fprintf(csv, "%s,\"%s\",%s,%zu,%.17g,", known->name, kinds[kind], spacings[spacing], n,
                100.0 * given / (trials - refused));
    const double chance = 100.0 * 3.0 * sqrt(0.05 * 0.95 / trials); /* of the count itself */
    for (int i = 0; i < 5; i++) {
        const double percent = 100.0 * hits[i] / (given > 0 ? given : 1);
        const int outside =
            !(percent >= least_of(known, kind, spacing, n) - chance && percent <= most_of(known) + chance);
        bad |= outside;
        printf(" %5.1f%s", percent, outside ? "!" : " ");
        if (csv) fprintf(csv, "%s%.17g", i == 0 ? "" : ",", percent);
    }
    bad |= given < 0.85 * (trials - refused) || refused > 0.5 * trials;
    printf("| %7.2g %7.2g\n", 100.0 * width / given, 100.0 * sqrt(square / given));
    if (csv) fprintf(csv, ",%.17g,%.17g\n", 100.0 * width / given, 100.0 * sqrt(square / given));
    return bad;
}

int main(int argc, char **argv) {
    static const size_t even[] = {3, 5, 8, 13, 30, LARGEST, 0}, wide[] = {3, 4, 5, 6, 7, 8, 10, 13, 20, 0};
    static const knowledge all[] = {{"nothing", 0, 8, 0, 0}, {"independent", 0, 3, 1, 0}, {"drift", 8, 8, 0, 1}};
    const int trials = argc > 1 ? atoi(argv[1]) : 2000;
    if (argc > 2) stream = (uint64_t)atoi(argv[2]);
    int bad = 0;
    if (argc > 3 && !(csv = fopen(argv[3], "w"))) return perror(argv[3]), 2;
    if (csv) fprintf(csv, "known,scatter,spacing,readings,given,slope,intercept,half,whole,twice,half_width,rms\n");
    printf("%-12s %-14s %-12s %4s %5s | %s\n", "known", "scatter", "volumes", "n", "given",
           "range holds [%]: slope, intercept, time to 1/2, 1, 2 of the volume | half width, rms [%]");
    for (size_t a = 0; a < sizeof all / sizeof *all; a++)
        for (int kind = all[a].first; kind <= all[a].last; kind++)
            for (int spacing = 0; spacing < SPACINGS; spacing += spacing == EVEN ? DOUBLING : 1)
                for (const size_t *n = spacing > EQUAL_TIMES ? wide : even; *n > 0; n++)
                    bad += trials_of(&all[a], kind, spacing, *n, spacing > EQUAL_TIMES ? trials / 5 : trials);
    printf("%d rows outside of their limits\n", bad);
    return csv && fclose(csv) ? 2 : bad > 0;
}
