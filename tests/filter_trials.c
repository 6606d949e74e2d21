/* Trials of filtration_evaluate: how often the ranges that it states hold what the readings were made from, over
   numbers of readings, spacings and kinds of scatter, with the defaults and nothing else given. scripts/verify
   filter_ranges builds and runs it; prints a table; leaves with 1 where a range holds outside of the limits.
     filter_trials [TRIALS] [SEED] [CSV]     trials of each kind (2000); the table as a file */
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

static const double slope = 5.175e8, end_volume = 14e-6; /* [s/m6], [m3] */

/* Readings of one test: scatter of `size` of the last time or volume. */
static void draw(int kind, size_t n, double intercept, int equal_times, double size, double *t, double *V) {
    const double end = (slope * end_volume + intercept) * end_volume, rough = kind >= 4 && kind <= 6 ? 0.6 : 0.0,
                 drift = 3.0 * normal();
    double error = normal(), walk = 0.0, before = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double share = (double)(i + 1) / (double)n;
        const double v = equal_times ? filtration_volume_of_time(slope, intercept, share * end) : share * end_volume;
        const double time = (slope * v + intercept) * v;
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
static double least_of(const knowledge *known, int kind, size_t n) {
    if (known->independent)
        /* Four laws of scatter are weighed, and few readings do not tell them. */
        return kind == 3 && n < 30 ? 89.0 : 91.0;
    /* Fewer readings see no walk of a balance; the ranges widen, but not far enough. */
    if (kind == 7) return n > 100 ? 92.0 : 84.0;
    if (kind >= 4 && kind <= 6) return n > 20 ? 92.0 : 90.0;
    return 93.0;
}
/* The most: where nothing is known the ranges allow for a drift, and are too wide where there is none. */
static double most_of(const knowledge *known) { return known->independent ? 99.2 : 100.0; }

static FILE *csv;

static int trials_of(const knowledge *known, int kind, size_t n, int trials) {
    static const double intercepts[] = {1700.0, 300.0, 8000.0};
    int given = 0, hits[5] = {0, 0, 0, 0, 0}, bad = 0;
    double width = 0.0, square = 0.0;
    for (int trial = 0; trial < trials; trial++) {
        double t[LARGEST], V[LARGEST];
        const double intercept = intercepts[trial % 3], size = n > 50 ? 0.001 : 0.004;
        draw(kind, n, intercept, trial / 3 % 2, size, t, V);
        filtration_curve_def def = filtration_curve_default_def();
        filtration_curve c;
        def.independent = known->independent;
        if (known->drift) def.drift_error = 3.0 * size * end_volume;
        if (filtration_evaluate(&def, n, t, V, &c) != FILTRATION_OK) {
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
    printf("%-12s %-14s %4zu %5.1f |", known->name, kinds[kind], n, 100.0 * given / trials);
    if (csv) fprintf(csv, "%s,\"%s\",%zu,%.17g,", known->name, kinds[kind], n, 100.0 * given / trials);
    const double chance = 100.0 * 3.0 * sqrt(0.05 * 0.95 / trials); /* of the count itself */
    for (int i = 0; i < 5; i++) {
        const double percent = 100.0 * hits[i] / (given > 0 ? given : 1);
        const int outside = !(percent >= least_of(known, kind, n) - chance && percent <= most_of(known) + chance);
        bad |= outside;
        printf(" %5.1f%s", percent, outside ? "!" : " ");
        if (csv) fprintf(csv, "%s%.17g", i == 0 ? "" : ",", percent);
    }
    bad |= given < 0.85 * trials;
    printf("| %7.2g %7.2g\n", 100.0 * width / given, 100.0 * sqrt(square / given));
    if (csv) fprintf(csv, ",%.17g,%.17g\n", 100.0 * width / given, 100.0 * sqrt(square / given));
    return bad;
}

int main(int argc, char **argv) {
    static const size_t numbers[] = {3, 5, 8, 13, 30, LARGEST};
    static const knowledge all[] = {{"nothing", 0, 8, 0, 0}, {"independent", 0, 3, 1, 0}, {"drift", 8, 8, 0, 1}};
    const int trials = argc > 1 ? atoi(argv[1]) : 2000;
    if (argc > 2) stream = (uint64_t)atoi(argv[2]);
    int bad = 0;
    if (argc > 3 && !(csv = fopen(argv[3], "w"))) return perror(argv[3]), 2;
    if (csv) fprintf(csv, "known,scatter,readings,given,slope,intercept,half,whole,twice,half_width,rms\n");
    printf("%-12s %-14s %4s %5s | %s\n", "known", "scatter", "n", "given",
           "range holds [%]: slope, intercept, time to 1/2, 1, 2 of the volume | half width, rms [%]");
    for (size_t a = 0; a < sizeof all / sizeof *all; a++)
        for (int kind = all[a].first; kind <= all[a].last; kind++)
            for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
                bad += trials_of(&all[a], kind, numbers[k], trials);
    printf("%d rows outside of their limits\n", bad);
    return csv && fclose(csv) ? 2 : bad > 0;
}
