/* Trials of the fits: random noisy sets of many kinds. A set with more distinct points than free parameters must be
   fitted, or refused with the status that names what its points leave open, and the fit must never be worse than the
   best curve on a border of the parameters. scripts/verify fits builds and runs it; prints what it counted; leaves
   with 1 if a set failed.
     fit_trials [N] [M]     N sets of classifier_fit and blocking_fit (10000), M of screen_fit for each model (300) */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "blocking.h"
#include "classifier.h"
#include "screen_models.h"
#include "../examples/common/random.h"

static uint64_t state = 20261126;
static double share(void) { return random_plain(&state); }
static double between(double low, double high) { return low + (high - low) * share(); }
static double normal(void) {
    const double u = share(), v = share();
    return sqrt(-2.0 * log(u + 1e-300)) * cos(2.0 * RIDDLE_PI * v);
}

static int failures;
static void failed(const char *fit, int set, const char *what, double got, double border) {
    if (failures++ < 20) printf("%s, set %d: %s %.12g, on a border %.12g\n", fit, set, what, got, border);
}
static int is_worse(double rms, double border) { return !(rms <= border * (1.0 + 1e-9) + 1e-9); }

/* The least of a function of ln x over a range: a grid, then golden sections about its best point. */
typedef double (*one_parameter)(double x, const void *user);
static double least(one_parameter f, const void *user, double low, double high) {
    enum { GRID = 300 };
    const double a = log(low), b = log(high), golden = 0.6180339887498949;
    int at = 0;
    double best = HUGE_VAL;
    for (int k = 0; k <= GRID; k++) {
        const double v = f(exp(a + (b - a) * k / GRID), user);
        if (v < best) best = v, at = k;
    }
    double from = a + (b - a) * (at - 1) / GRID, to = a + (b - a) * (at + 1) / GRID;
    for (int k = 0; k < 60; k++) {
        const double p = to - golden * (to - from), q = from + golden * (to - from), fp = f(exp(p), user),
                     fq = f(exp(q), user);
        if (fp < fq) to = q;
        else from = p;
        best = fmin(best, fmin(fp, fq));
    }
    return best;
}

/* ---- classifier_fit ---- */

typedef struct curve_data {
    int n;
    double x[24], t[24], slope;
    classifier_curve_law law;
} curve_data;

static double curve_rms(const curve_data *d, const classifier_curve *c) {
    double sum = 0.0;
    for (int i = 0; i < d->n; i++) {
        const double miss = d->t[i] - classifier_curve_value(c, d->x[i]);
        sum += miss * miss;
    }
    return sqrt(sum / d->n);
}
static double at_slope(double size, const void *user) {
    const curve_data *d = user;
    const classifier_curve c = classifier_curve_of(d->law, size, d->slope);
    return curve_rms(d, &c);
}
/* A step between any two sizes, with the best share that passes below it. */
static double step_rms(const curve_data *d, int with_bypass) {
    double best = HUGE_VAL;
    for (int k = 0; k < d->n; k++) {
        double below = 0.0, number = 0.0, sum = 0.0;
        for (int i = 0; i < d->n; i++)
            if (d->x[i] < d->x[k]) below += d->t[i], number += 1.0;
        const double bypass = with_bypass && number > 0.0 ? fmin(1.0, fmax(0.0, below / number)) : 0.0;
        for (int i = 0; i < d->n; i++) sum += pow(d->t[i] - (d->x[i] < d->x[k] ? bypass : 1.0), 2.0);
        best = fmin(best, sqrt(sum / d->n));
    }
    return best;
}

static void make_curve(curve_data *d, int set) {
    const int kind = set % 8;
    const double size = 1e-5, slope = between(0.6, 6.0), bypass = kind == 1 ? between(0.0, 0.4) : 0.0,
                 first = between(0.1, 0.9),
                 scatter = kind == 2   ? 0.0
                           : kind == 3 ? 0.15
                                       : between(0.005, 0.03);
    d->n = 3 + (int)(18.0 * share());
    d->law = (classifier_curve_law)(set / 8 % 3);
    for (int i = 0; i < d->n; i++) {
        d->x[i] = first * size * pow(between(1.5, 12.0) / first, i / (d->n - 1.0));
        /* Some sizes twice. */
        if (i > 0 && d->x[i] <= d->x[i - 1]) d->x[i] = d->x[i - 1] * (kind == 4 && share() < 0.5 ? 1.0 : 1.1);
        d->t[i] = bypass + (1.0 - bypass) * (1.0 - exp(-log(2.0) * pow(d->x[i] / size, slope))) + scatter * normal();
    }
    if (kind == 5) d->t[(int)(d->n * share())] = share();                             /* an outlier */
    for (int i = 0; kind == 6 && i < d->n; i++) d->t[i] = d->x[i] < size ? 0.0 : 1.0; /* a step */
    for (int i = 0; kind == 7 && i < d->n; i++) d->t[i] = 0.5 + 0.05 * normal();      /* flat */
}

static int distinct(const double *x, int n) { /* in ascending order */
    int m = 1;
    for (int i = 1; i < n; i++) m += x[i] != x[i - 1];
    return m;
}

static void try_curves(int sets) {
    int fitted[3] = {0, 0, 0}, refused[3] = {0, 0, 0}, border = 0;
    for (int set = 0; set < sets; set++) {
        curve_data d;
        classifier_fit_result fit[3];
        int above = 0, below = 0;
        double best[3], mean = 0.0, flat = 0.0;
        make_curve(&d, set);
        for (int i = 0; i < d.n; i++) above += d.t[i] > 0.5, below += d.t[i] < 0.5;
        for (int i = 0; i < d.n; i++) mean += d.t[i] / d.n;
        for (int i = 0; i < d.n; i++) flat += (d.t[i] - mean) * (d.t[i] - mean) / d.n;
        d.slope = d.law == CLASSIFIER_MOLERUS_HOFFMANN ? 0.0 : 1e-6; /* least slopes */
        best[0] = fmin(step_rms(&d, 0), least(at_slope, &d, 1e-9, 1e-2));
        best[1] = best[2] = fmin(best[0], step_rms(&d, 1));
        for (int free = 0; free < 3; free++) {
            const unsigned bits = free == 0 ? 0u : free == 1 ? CLASSIFIER_FREE_BYPASS : CLASSIFIER_FREE_HOOK;
            const int parameters = 2 + free, enough = distinct(d.x, d.n) > parameters;
            const classifier_status status = classifier_fit(d.law, bits, d.x, d.t, NULL, d.n, &fit[free]);
            if (status != CLASSIFIER_OK) {
                const classifier_status wanted = !enough ? CLASSIFIER_TOO_FEW : CLASSIFIER_OUTSIDE;
                const int is_open = above == 0 || below == 0 || (best[free] > 0.0 && !is_worse(sqrt(flat), best[free]));
                if (status != wanted || (enough && !is_open))
                    failed("classifier", set, classifier_status_text(status), free, 0);
                refused[free]++;
                continue;
            }
            fitted[free]++;
            border += fit[free].at_border != 0;
            if (is_worse(fit[free].rms, best[free])) failed("classifier", set, "rms", fit[free].rms, best[free]);
            if (free > 0 && fit[free - 1].rms > 0.0 && is_worse(fit[free].rms, fit[free - 1].rms) &&
                distinct(d.x, d.n) > parameters - 1)
                failed("classifier", set, "rms with one more free", fit[free].rms, fit[free - 1].rms);
            const double said = curve_rms(&d, &fit[free].curve);
            if (!(fabs(said - fit[free].rms) <= 1e-9))
                failed("classifier", set, "rms, not that of the curve", fit[free].rms, said);
            if (!(fit[free].curve.bypass >= 0.0 && fit[free].curve.bypass < 1.0) || !(fit[free].curve.size > 0.0))
                failed("classifier", set, "a parameter outside its range", fit[free].curve.bypass,
                       fit[free].curve.size);
        }
    }
    for (int free = 0; free < 3; free++)
        printf("classifier_fit, %s: %d fitted, %d refused\n",
               free == 0   ? "size and slope"
               : free == 1 ? "bypass"
                           : "hook",
               fitted[free], refused[free]);
    printf("classifier_fit: %d with a parameter at its border\n", border);
}

/* ---- blocking_fit ---- */

typedef struct readings {
    int n;
    double t[12], f[12], end;
} readings;

/* With f_inf at `end` and the best f0 in its range. */
static double at_end(double k, const void *user) {
    const readings *r = user;
    double ee = 0.0, ef = 0.0, sum = 0.0;
    for (int j = 0; j < r->n; j++) {
        const double e = exp(-k * r->t[j]);
        ee += e * e, ef += e * (r->f[j] - r->end * (1.0 - e));
    }
    const double start = ee > 0.0 ? fmin(1.0, fmax(0.0, ef / ee)) : 0.0;
    for (int j = 0; j < r->n; j++) sum += pow(r->f[j] - r->end - (start - r->end) * exp(-k * r->t[j]), 2.0);
    return sqrt(sum / r->n);
}

static void try_readings(int sets) {
    const blocking_fit_def def = blocking_default_fit_def();
    int fitted = 0, left_open = 0, refused = 0;
    for (int set = 0; set < sets; set++) {
        readings r;
        blocking_fit_result fit;
        const int kind = set % 7;
        const double f0 = share(), f_inf = kind == 1 ? (double)(set / 7 % 2) : share(), k = exp(between(-7.0, 1.0)),
                     noise = kind == 2   ? 0.0
                             : kind == 3 ? 0.3
                                         : between(0.003, 0.05);
        double now = kind == 4 ? between(0.0, 5.0) : 0.0, mean = 0.0, best, sum = 0.0;
        r.n = 4 + (int)(8.0 * share());
        for (int j = 0; j < r.n; j++) {
            r.t[j] = now;
            now += between(0.05, 20.0);
            r.f[j] = fmin(1.0, fmax(0.0, f_inf + (f0 - f_inf) * exp(-k * r.t[j]) + noise * normal()));
        }
        if (kind == 5) r.f[(int)(r.n * share())] = share();
        for (int j = 0; kind == 6 && j < r.n; j++) r.f[j] = set % 2 ? 0.5 : share();
        const blocking_status status = blocking_fit(&def, r.t, r.f, NULL, (size_t)r.n, &fit);
        if (status > BLOCKING_NOT_RESOLVED) {
            failed("blocking", set, blocking_status_text(status), r.n, 0);
            refused++;
            continue;
        }
        fitted += status == BLOCKING_OK, left_open += status != BLOCKING_OK;
        for (int j = 0; j < r.n; j++) mean += r.f[j] / r.n;
        for (int j = 0; j < r.n; j++) sum += (r.f[j] - mean) * (r.f[j] - mean);
        best = sqrt(sum / r.n);
        if (status == BLOCKING_NO_CHANGE) continue; /* equal readings: the constant, and k is open */
        for (int c = 0; c < 2; c++) r.end = c, best = fmin(best, least(at_end, &r, 1e-6, 1e3));
        if (is_worse(sqrt(fit.sse / r.n), best)) failed("blocking", set, "rms", sqrt(fit.sse / r.n), best);
        if (!(fit.k_lowest <= fit.k && fit.k <= fit.k_highest && fit.f_inf_lowest <= fit.f_inf &&
              fit.f_inf <= fit.f_inf_highest))
            failed("blocking", set, "a value outside its own range", fit.k, fit.f_inf);
    }
    printf("blocking_fit: %d fitted, %d that leave something open, %d refused\n", fitted, left_open, refused);
}

/* ---- screen_fit ---- */

/* Two classes on a batch screen, one to three cases. */
static const double diameters[2] = {0.005, 0.007};
typedef struct screen_data {
    int cases;
    screen_case one[3];
    double time[3][12], y[3][24];
} screen_data;

static void make_cases(screen_data *d, int set) {
    const int kind = set % 7;
    const double rate[2] = {between(0.05, 3.0), between(0.02, 1.0)}, noise = kind > 2 ? between(0.005, 0.1) : 0.0;
    d->cases = 1 + set / 7 % 3;
    for (int c = 0; c < d->cases; c++) {
        screen_case *one = &d->one[c];
        memset(one, 0, sizeof *one);
        one->operation.amplitude = between(0.0008, 0.0012), one->operation.frequency = between(35.0, 55.0);
        one->operation.moisture = between(0.0, 0.05);
        one->times = 3 + (int)(10.0 * share()), one->time = d->time[c], one->retained = d->y[c];
        for (int j = 0; j < one->times; j++) d->time[c][j] = 0.4 * (j + 1) + 0.2 * share();
        for (int k = 0; k < 2 * one->times; k++) {
            const double clean = exp(-rate[k / one->times] * d->time[c][k % one->times]);
            d->y[c][k] = kind == 0 ? 1.0 : kind == 1 ? 0.0 : fmin(1.0, fmax(0.0, clean + noise * normal()));
        }
        if (kind == 6) d->y[c][(int)(2.0 * one->times * share())] = share();
    }
}

static void try_screens(int sets) {
    screen_def def = screen_default_def();
    def.classes = 2, def.diameters = diameters, def.ratio = SCREEN_RATIO_GRAIN;
    for (int m = 0; m < 3; m++) {
        int fitted = 0, refused = 0;
        for (int set = 0; set < sets; set++) {
            screen_data d;
            screen_fit_result fit, border;
            screen_fit_options options = screen_default_fit_options((screen_model)m);
            make_cases(&d, set);
            options.starts = 20, options.loss = SCREEN_LOSS_SQUARES;
            const screen_status status = screen_fit(&def, (screen_model)m, d.cases, d.one, &options, &fit);
            if (status != SCREEN_OK) {
                refused++;
                failed("screen_fit", set, screen_status_text(status), m, d.cases);
                continue;
            }
            fitted++;
            for (int j = 0; j < fit.parameters; j++) {
                for (int side = 0; side < 2; side++) {
                    screen_fit_options held = options;
                    held.low[j] = held.high[j] = side ? options.high[j] : options.low[j];
                    if (screen_fit(&def, (screen_model)m, d.cases, d.one, &held, &border) != SCREEN_OK) continue;
                    /* model 2 has valleys that run to infinity: there the last digits are not reached */
                    if (is_worse(fit.rms, border.rms * (m == 2 ? 1.0 + 1e-5 : 1.0)))
                        failed("screen_fit", set, "rms", fit.rms, border.rms);
                }
            }
        }
        printf("screen_fit, model %d: %d fitted, %d refused\n", m, fitted, refused);
    }
}

int main(int argc, char **argv) {
    const int sets = argc > 1 ? atoi(argv[1]) : 10000, screens = argc > 2 ? atoi(argv[2]) : 300;
    if (sets < 1 || screens < 1) return 2;
    try_curves(sets), try_readings(sets), try_screens(screens);
    printf("%d failures\n", failures);
    return failures > 0;
}
