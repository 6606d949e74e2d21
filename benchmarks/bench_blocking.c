/* blocking.h: error against run time.

   1. The blocking ODE with changing rates: a deck whose toss indicator is raised for 20 s every 2 minutes while the
      feed's hard-to-screen content drifts. Explicit Euler and classical Runge-Kutta with fixed steps, the exact step
      with rates frozen at its middle, and blocking_integrate by its tolerance, against blocking_integrate at 1e-14.
   2. The two estimators of k: error over many repeated counts of the same sieve, against the number of holes counted,
      and their run time.
   3. Time a call. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "blocking.h"
#include "common.h"

/* ---- 1: the ODE ---- */

enum { POINTS = 21, LEVELS = 12, METHODS = 4 };

static const double run_s = 600.0;

typedef struct deck {
    double breaks[POINTS], K[POINTS], x_h[POINTS];
    blocking_schedule schedule;
} deck;

/* Not a published law: rate constants of the size of Table 2 that rise with throw and hard grains */
static void law(void *user, double K, double x_h, double *k1, double *k2) {
    (void)user;
    *k1 = 0.02 * x_h * x_h / (0.5 + K);
    *k2 = 0.004 * K * sqrt(K);
}

static void make_deck(deck *d) {
    int n = 0;
    for (int cycle = 0; cycle < 5; cycle++) {
        const double at[4] = {0.0, 98.0, 100.0, 119.0}, K[4] = {1.5, 1.5, 4.9, 4.9}; /* ramps of 2 s up and 1 s down */
        for (int i = 0; i < 4; i++, n++) {
            d->breaks[n] = 120.0 * cycle + at[i];
            d->K[n] = K[i];
        }
    }
    d->breaks[n] = run_s;
    d->K[n] = 1.5;
    for (int i = 0; i < POINTS; i++) d->x_h[i] = 0.3 + 0.4 * d->breaks[i] / run_s;
    blocking_schedule s = {d->breaks, d->K, d->x_h, POINTS, 0, law, NULL};
    d->schedule = s;
}

static double derivative(deck *d, double t, double f) {
    double k1, k2;
    blocking_schedule_rates(&d->schedule, t, &k1, &k2);
    return k2 * (1.0 - f) - k1 * f;
}

static double euler(deck *d, int steps) {
    double f = 1.0, h = run_s / steps;
    for (int i = 0; i < steps; i++) f += h * derivative(d, i * h, f);
    return f;
}

static double runge_kutta(deck *d, int steps) {
    double f = 1.0, h = run_s / steps;
    for (int i = 0; i < steps; i++) {
        double t = i * h, a = derivative(d, t, f), b = derivative(d, t + 0.5 * h, f + 0.5 * h * a);
        double c = derivative(d, t + 0.5 * h, f + 0.5 * h * b), e = derivative(d, t + h, f + h * c);
        f += h * (a + 2.0 * b + 2.0 * c + e) / 6.0;
    }
    return f;
}

static double frozen(deck *d, int steps) {
    double f = 1.0, h = run_s / steps, k1, k2;
    for (int i = 0; i < steps; i++) {
        blocking_schedule_rates(&d->schedule, (i + 0.5) * h, &k1, &k2);
        f = blocking_free_fraction(f, k1, k2, h);
    }
    return f;
}

static double adaptive(deck *d, double tolerance) {
    blocking_ode_def def = blocking_default_ode_def();
    def.rates = blocking_schedule_rates;
    def.user = &d->schedule;
    def.breaks = d->breaks;
    def.n_breaks = POINTS;
    def.tolerance = tolerance;
    double f;
    return blocking_integrate(&def, &run_s, 1, &f, NULL, NULL) == BLOCKING_OK ? f : (double)NAN;
}

static const char *const methods[METHODS] = {"explicit Euler", "Runge-Kutta 4", "frozen rates, exact step",
                                             "blocking_integrate"};

static double solve(deck *d, int method, int level) {
    const int steps = 50 << level; /* 12 s .. 6 ms */
    switch (method) {
    case 0: return euler(d, steps);
    case 1: return runge_kutta(d, steps);
    case 2: return frozen(d, steps);
    default: return adaptive(d, pow(10.0, -2.0 - level));
    }
}

static void ode(const program *self, json *report, riddle_plot *figure) {
    deck d;
    make_deck(&d);
    const double exact = adaptive(&d, 1e-14);
    static const result_column columns[] = {{"method", "blocking ODE, 600 s", "%s"},
                                            {"|level"},
                                            {"error", "error", "%.2e"},
                                            {"run_time_s", "run time [us]", "%.1f", 1e6}};
    result_table *t = RESULTS(columns);
    riddle_plot_panel(figure, 0, 0, "run time [s]", "error of f after 600 s [-]");
    riddle_plot_title(figure, "Changing rates");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    for (int m = 0; m < METHODS; m++) {
        double error[LEVELS], seconds[LEVELS];
        int n = 0;
        for (int level = 0; level < LEVELS && !common_interrupted(); level++) {
            double start = machine_seconds(), f = 0.0, least = self->quick ? 0.002 : 0.02;
            int repeats = 0;
            do {
                f = solve(&d, m, level);
                repeats++;
            } while (machine_seconds() - start < least);
            seconds[n] = (machine_seconds() - start) / repeats;
            error[n] = fmax(fabs(f - exact), 1e-16);
            results_row(t, TEXTS(methods[m]), level, error[n], seconds[n]);
            n++;
        }
        riddle_plot_line(figure, methods[m], seconds, error, n);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    }
    results_write(t, report, "ode", self->out, "blocking_ode.csv");
    results_free(t);
}

/* ---- 2: the estimators ---- */

static int ascending(const void *a, const void *b) {
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

/* Fit 7b of the paper at its times, `holes` counted at each. Least squares over all; three readings at 0, 128, 256 s (k
   t = 1.3: near the best 1.59). Error: median of |k / 0.0101 - 1|, an estimate that fails counts as infinite. */
static void estimators(const program *self, json *report, riddle_plot *figure) {
    enum { TIMES = 13, SIZES = 8, MOST = 2000 };
    static double error[2][MOST];
    double t[TIMES], holes[SIZES], median[2][SIZES], failed[2][SIZES];
    for (int i = 0; i < TIMES; i++) t[i] = i ? ldexp(1.0, i - 1) : 0.0;
    const int trials = self->quick ? 200 : MOST;
    uint64_t seed = self->seed;
    blocking_fit_def def = blocking_default_fit_def();
    static const result_column columns[] = {{"holes", "holes counted", "%.0f"},
                                            {"least_squares_error", "least squares: median error of k", "%.2e"},
                                            {"least_squares_failed", "failed [%]", "%.1f", 100.0},
                                            {"three_point_error", "three readings: median error of k", "%.2e"},
                                            {"three_point_failed", "failed [%]", "%.1f", 100.0}};
    result_table *table = RESULTS(columns);
    for (int s = 0; s < SIZES && !common_interrupted(); s++) {
        holes[s] = 100.0 * (1 << 2 * s);
        failed[0][s] = failed[1][s] = 0.0;
        for (int trial = 0; trial < trials; trial++) {
            double f[TIMES], sigma[TIMES];
            for (int i = 0; i < TIMES; i++) { /* a normal deviate stands for the binomial one */
                double exact = blocking_curve(.949, .714, .0101, t[i]), normal = -6.0;
                for (int j = 0; j < 12; j++) normal += random_share(&seed);
                sigma[i] = sqrt(exact * (1.0 - exact) / holes[s]);
                f[i] = fmin(1.0, exact + sigma[i] * normal);
            }
            blocking_fit_result fit;
            blocking_status status = blocking_fit(&def, t, f, sigma, TIMES, &fit);
            error[0][trial] = status == BLOCKING_OK ? fabs(fit.k / .0101 - 1.0) : HUGE_VAL;
            const double t3[3] = {t[0], t[8], t[9]}, f3[3] = {f[0], f[8], f[9]};
            blocking_estimate e;
            status = blocking_three_point(t3, f3, 0.0, BLOCKING_TOLERANCE, &e);
            error[1][trial] =
                status == BLOCKING_OK || status == BLOCKING_OUT_OF_RANGE ? fabs(e.k / .0101 - 1.0) : HUGE_VAL;
            for (int m = 0; m < 2; m++) failed[m][s] += !(error[m][trial] < HUGE_VAL) / (double)trials;
        }
        for (int m = 0; m < 2; m++) {
            qsort(error[m], (size_t)trials, sizeof(double), ascending);
            median[m][s] = error[m][trials / 2];
        }
        results_row(table, NULL, holes[s], median[0][s], failed[0][s], median[1][s], failed[1][s]);
    }
    results_print(table);
    results_csv(table, self->out, "blocking_estimators.csv");
    results_free(table);
    json_array(report, "holes", holes, SIZES);
    json_array(report, "least_squares_median_error", median[0], SIZES);
    json_array(report, "three_point_median_error", median[1], SIZES);
    riddle_plot_panel(figure, 0, 1, "holes counted at each time", "median error of k, relative [-]");
    riddle_plot_title(figure, "Lawinska et al. (2016), row 7b, counted holes");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    riddle_plot_line(figure, "three readings, 0 128 256 s", holes, median[1], SIZES);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_line(figure, "least squares, 13 readings", holes, median[0], SIZES);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
}

/* ---- 3: time a call ---- */

enum { CALLS = 7 };
static const char *const calls[CALLS] = {"blocking_free_fraction",
                                         "blocking_time_mean",
                                         "blocking_table3",
                                         "blocking_time_for_exposure",
                                         "blocking_three_point",
                                         "blocking_fit, 13 readings",
                                         "blocking_polynomial_fit, 55 points"};

static double one_call(int which, double u) {
    static double t[13], f[13], x[55][2], y[55], work[BLOCKING_POLYNOMIAL_WORK(55, 10)];
    switch (which) {
    case 0: return blocking_free_fraction(0.9, 0.01 * u, 0.02, 50.0);
    case 1: return blocking_time_mean(0.9, 0.3, 0.02 * u, 50.0);
    case 2: return blocking_table3(BLOCKING_SPHERICAL, 1.0 + 3.0 * u, 0.5);
    case 3: return blocking_time_for_exposure(100.0 * u, 0.9, 0.3, 0.02);
    case 4: {
        const double t3[3] = {0.0, 10.0, 25.0}, f3[3] = {0.9, 0.7 + 0.02 * u, 0.6};
        blocking_estimate e;
        blocking_three_point(t3, f3, 0.01, BLOCKING_TOLERANCE, &e);
        return e.k;
    }
    case 5: {
        blocking_fit_def def = blocking_default_fit_def();
        blocking_fit_result fit;
        for (int i = 0; i < 13; i++) {
            t[i] = i ? ldexp(1.0, i - 1) : 0.0;
            f[i] = blocking_curve(0.9, 0.6, 0.01 + 0.01 * u, t[i]) + 0.01 * (i % 3 - 1);
        }
        blocking_fit(&def, t, f, NULL, 13, &fit);
        return fit.k;
    }
    default: {
        const int powers[10][2] = {{1, 2}, {0, 3}, {0, 2}, {0, 1}, {1, 1}, {2, 1}, {0, 0}, {1, 0}, {2, 0}, {3, 0}};
        double a[10];
        for (int i = 0; i < 55; i++) {
            x[i][0] = 0.62 + i / 11;
            x[i][1] = 0.1 * (i % 11);
            y[i] = blocking_table3(BLOCKING_IRREGULAR, x[i][0], x[i][1]) + 0.01 * u;
        }
        blocking_polynomial_fit(&x[0][0], y, 55, &powers[0][0], 10, 2, a, NULL, work, NULL);
        return a[0];
    }
    }
}

static void times(const program *self, json *report) {
    result_value values[CALLS];
    int n_values = 0;
    volatile double sink = 0.0;
    json_object_begin(report, "ns_per_call");
    for (int c = 0; c < CALLS && !common_interrupted(); c++) {
        double start = machine_seconds(), least = self->quick ? 0.02 : 0.2, spent;
        long n = 0;
        do {
            double sum = 0.0;
            for (int i = 0; i < 100; i++) sum += one_call(c, (i + 0.5) / 100.0);
            sink = sink + sum;
            n += 100;
        } while ((spent = machine_seconds() - start) < least);
        const result_value value = {calls[c], 1e9 * spent / (double)n, calls[c], "%.1f ns"};
        values[n_values++] = value;
    }
    results_say(report, values, n_values);
    json_object_end(report);
}

int main(int argc, char **argv) {
    program self = program_start("bench_blocking", "blocking.h: error against run time.", NULL, 0, argc, argv);
    json *report = json_open(self.json);
    riddle_plot *figure = riddle_plot_new("blocking.h: error against run time, and against effort", 1, 2);
    ode(&self, report, figure);
    common_print("\n");
    estimators(&self, report, figure);
    common_print("\n");
    times(&self, report);
    riddle_plot_write(figure, self.out, "bench_blocking.svg");
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
