/* screen_models.h: error against run time.

   1. Model 1's implicit equation: bisection, Newton from 0 and screen_dong; largest error over p in [0, 1], N in [0,
      1e12].
   2. Model 3, initial case: the paper's explicit step, the positive step of fixed length, the adaptive integrator;
      published parameters, where stratification is over in a millisecond, and a slow set; against the adaptive
      integrator at 1e-14.
   3. The fitter: random starts against the deviation reached, on curves of model 2 with noise and on curves that no
      model meets.
   4. Time a call. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "screen_models.h"

static const double diameters[] = {0.005, 0.007};

static screen_def batch(void) {
    screen_def def = screen_default_def();
    def.classes = 2;
    def.diameters = diameters;
    def.ratio = SCREEN_RATIO_RETAINED;
    return def;
}

static volatile double sink; /* keeps results that nobody else reads */

/* ---- 1: the implicit equation ---- */

enum { PLACES = 2000 };
static double place_p[PLACES], place_n[PLACES], place_y[PLACES];

static double bisection(double p, double n, int k) {
    double low = 0.0, high = 1.0;
    for (int i = 0; i < k; i++) {
        double y = 0.5 * (low + high);
        if (y == 0.0 || riddle_log(y) < n * riddle_log1p(-p * y)) low = y;
        else high = y;
    }
    return 0.5 * (low + high);
}

static double newton(double p, double n, int k) {
    double s = p < 1.0 ? 0.0 : 1e-3;
    for (int i = 0; i < k; i++) {
        double u = p * riddle_exp(-s);
        s -= (s + n * riddle_log1p(-u)) / (1.0 + n * (u / (1.0 - u)));
    }
    return riddle_exp(-s);
}

static double ours(double p, double n, int k) {
    (void)k;
    return screen_dong(p, n);
}

static void bench_implicit(const program *self, riddle_plot *figure, json *report) {
    typedef struct method {
        const char *name;
        double (*solve)(double, double, int);
        int first, last, step;
    } method;
    static const method methods[] = {
        {"bisection", bisection, 10, 60, 10}, {"Newton from 0", newton, 4, 28, 4}, {"screen_dong", ours, 1, 1, 1}};
    uint64_t random = self->seed;
    for (int i = 0; i < PLACES; i++) {
        place_p[i] = screen__uniform(&random);
        place_n[i] = i % 8 == 0 ? screen__uniform(&random) : riddle_exp(27.6 * screen__uniform(&random));
        if (i % 10 == 1) place_p[i] = 1.0;
        place_y[i] = bisection(place_p[i], place_n[i], 1100); /* to the last bit that the logarithms allow */
    }
    riddle_io_file *file = csv_open(self->out, "implicit.csv", "method,iterations,error,ns_per_call");
    riddle_plot_panel(figure, 0, 0, "time per call [ns]", "largest relative error of Y [-]");
    riddle_plot_title(figure, "Dong: Y = (1 - p Y)^N");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    for (size_t m = 0; m < sizeof methods / sizeof methods[0]; m++) {
        double x[16], y[16];
        int n = 0;
        for (int k = methods[m].first; k <= methods[m].last; k += methods[m].step, n++) {
            double worst = 1e-17, total = 0.0, start = machine_processor_seconds();
            int rounds = self->quick ? 2 : 40;
            for (int round = 0; round < rounds; round++)
                for (int i = 0; i < PLACES; i++) total += methods[m].solve(place_p[i], place_n[i], k);
            x[n] = 1e9 * (machine_processor_seconds() - start) / ((double)rounds * PLACES);
            sink = total;
            for (int i = 0; i < PLACES; i++)
                worst = fmax(worst, fabs(methods[m].solve(place_p[i], place_n[i], k) / place_y[i] - 1.0));
            y[n] = worst;
            csv_line(file, "%s,%d,%.17g,%.17g", methods[m].name, k, y[n], x[n]);
        }
        riddle_plot_line(figure, methods[m].name, x, y, n);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
        common_print("model 1, %-14s %7.0f ns, error %.1e\n", methods[m].name, x[n - 1], y[n - 1]);
        if (methods[m].solve == ours) {
            json_number(report, "dong_s_per_call", 1e-9 * x[n - 1]);
            json_number(report, "dong_largest_relative_error", y[n - 1]);
        }
    }
    riddle_io_close(file);
}

/* ---- 2: model 3 ---- */

static const double when[] = {0.5, 1.0, 2.0, 5.0, 10.0, 20.0};
enum { WHEN = 6 };

/* The paper's explicit step; eqs 36-43 with the laws of the header. */
static void euler(const screen_def *def, const double *p, const screen_operation *o, double step, double *y) {
    double s[2] = {0.0, 0.0}, b[2] = {0.0, 0.0}, retained[2] = {0.5, 0.5}, w[2], rate[2], volume[2], now = 0.0;
    for (int i = 0; i < 2; i++) {
        double d = diameters[i];
        w[i] = screen_rate(p[0], p[1], p[2], o->amplitude, o->frequency, o->moisture, d, d / 0.006, def->gravity);
        rate[i] =
            screen_rate(p[3], p[4], p[5], o->amplitude, o->frequency, o->moisture, d, d / def->aperture, def->gravity);
        volume[i] = d * d * d;
    }
    for (int j = 0; j < WHEN; j++) {
        while (now < when[j] - 1e-12) {
            double h = fmin(step, when[j] - now), fines = 0.0, grains = 0.0,
                   coarse = def->oversize_mass / def->undersize_mass;
            for (int i = 0; i < 2; i++) {
                fines += 0.5 - s[i];
                grains += (0.5 - s[i]) / volume[i];
            }
            double d_c = def->coarse_diameter, mass = fines + coarse, q = fines / mass;
            double mean = mass / (grains + coarse / (d_c * d_c * d_c));
            double layers = screen_top_layers(mass * def->undersize_mass, def->deck_area, def->bulk_density, d_c);
            for (int i = 0; i < 2; i++) {
                double c = riddle_exp(screen_log_stratification(riddle_log(w[i]), screen_log_fines_factor(q),
                                                                screen_log_size_factor(volume[i], mean), layers));
                double out = rate[i] * retained[i] * b[i], in = c * (0.5 - s[i]);
                s[i] += h * in;
                b[i] += h * (in - out);
                retained[i] -= h * out;
            }
            now += h;
        }
        for (int i = 0; i < 2; i++) y[i * WHEN + j] = 2.0 * retained[i];
    }
}

static double error_of(const double *y, const double *exact) {
    double worst = 0.0;
    for (int k = 0; k < 2 * WHEN; k++) {
        double off = fabs(y[k] - exact[k]);
        if (!(off < HUGE_VAL)) return HUGE_VAL;
        worst = fmax(worst, off);
    }
    return worst > 1e-16 ? worst : 1e-16;
}

static void bench_soldinger(const program *self, riddle_plot *figure, json *report) {
    const double slow[6] = {3.0, -1.5, 1.0, 4.0, -0.5, 2.0};
    double published[6], y[2 * WHEN], exact[2 * WHEN];
    screen_operation initial = {0.001, 50.6, 0.0, 0.0};
    screen_published(SCREEN_SOLDINGER, published);
    riddle_io_file *file = csv_open(self->out, "soldinger.csv", "parameters,method,step_or_tolerance,error,s_per_case");
    for (int set = 0; set < 2; set++) {
        const double *p = set ? slow : published;
        screen_def def = batch();
        def.tolerance = 1e-14;
        screen_predict(&def, SCREEN_SOLDINGER, p, &initial, WHEN, when, exact, NULL, NULL);
        riddle_plot_panel(figure, 1, set, "run time of a case [s]", "largest error of retained [-]");
        riddle_plot_title(figure, set ? "Soldinger, slow stratification" : "Soldinger, published parameters");
        riddle_plot_log_x(figure);
        riddle_plot_log_y(figure);
        for (int method = 0; method < 3; method++) {
            static const char *const names[] = {"explicit, as the paper", "positive, fixed step", "adaptive"};
            double seconds[16], errors[16];
            int n = 0, levels = self->quick ? 6 : method == 2 ? 11 : 8;
            for (int level = 0; level < levels; level++) {
                double setting = method == 2 ? riddle_exp(-2.302585092994046 * (2 + level))
                                             : 0.5 * riddle_exp(-1.3862943611198906 * level);
                def = batch();
                if (method == 1) def.fixed_step = setting;
                if (method == 2) def.tolerance = setting;
                int rounds = 1 + (int)((self->quick ? 0.01 : 0.05) / (method == 2 ? 3e-4 : 4e-7 * 20.0 / setting));
                double start = machine_processor_seconds();
                for (int round = 0; round < rounds; round++) {
                    if (method == 0) euler(&def, p, &initial, setting, y);
                    else screen_predict(&def, SCREEN_SOLDINGER, p, &initial, WHEN, when, y, NULL, NULL);
                }
                double t = (machine_processor_seconds() - start) / rounds, error = error_of(y, exact);
                csv_line(file, "%s,\"%s\",%.17g,%.17g,%.17g", set ? "slow" : "published", names[method], setting, error,
                         t);
                if (!(error < 10.0)) continue; /* the explicit step has diverged */
                seconds[n] = fmax(t, 1e-8);
                errors[n++] = error;
            }
            if (n) {
                riddle_plot_line(figure, names[method], seconds, errors, n);
                riddle_plot_style(figure, RIDDLE_PLOT_MARKED, method);
                common_print("model 3, %-9s %-23s best %.1e in %.1e s\n", set ? "slow" : "published", names[method],
                             errors[n - 1], seconds[n - 1]);
            } else {
                common_print("model 3, %-9s %-23s diverges at every step down to %.0e s\n", set ? "slow" : "published",
                             names[method], 0.5 * riddle_exp(-1.3862943611198906 * (levels - 1)));
                riddle_plot_text_share(figure, 0.29, 0.9, "explicit step: diverges at any size");
            }
            if (method == 2) {
                json_number(report, set ? "soldinger_slow_error" : "soldinger_published_error", errors[n - 1]);
                json_number(report, set ? "soldinger_slow_s" : "soldinger_published_s", seconds[n - 1]);
            }
        }
    }
    riddle_io_close(file);
}

/* ---- 3: the fitter ---- */

enum { CASES = 27, TIMES = 40, POINTS = 80 };
static double axis_t[TIMES], data[CASES][POINTS];

/* Curves of model 2 with scatter; misfit > 0: of a bed that in part never passes, which no model has */
static void make_cases(screen_case *cases, double noise, double misfit, uint64_t random) {
    screen_def def = batch();
    double p[6];
    screen_published(SCREEN_SUBASINGHE, p);
    for (int j = 0; j < TIMES; j++) axis_t[j] = 0.5 * (j + 1);
    for (int k = 0; k < CASES; k++) {
        screen_operation o = {0.0008 + 0.0002 * (k / 3 % 3), 45.8 + 4.8 * (k % 3), 0.025 * (k / 9), 0.0};
        cases[k].operation = o;
        cases[k].times = TIMES;
        cases[k].time = axis_t;
        cases[k].retained = data[k];
        screen_predict(&def, SCREEN_SUBASINGHE, p, &o, TIMES, axis_t, data[k], NULL, NULL);
        double stuck = misfit * (1.2e-3 - o.amplitude) / 0.4e-3 * (1.0 + 10.0 * o.moisture);
        for (int j = 0; j < POINTS; j++)
            data[k][j] = stuck + (1.0 - stuck) * data[k][j] + noise * screen__normal(&random);
    }
}

static void bench_fit(const program *self, riddle_plot *figure, json *report) {
    static const char *const names[] = {"0 first order", "1 Dong", "2 Subasinghe"};
    screen_case cases[CASES];
    screen_def def = batch();
    riddle_io_file *file = csv_open(self->out, "fit.csv", "data,model,starts,deviation,above_best,processor_s");
    for (int set = 0; set < 2; set++) {
        make_cases(cases, set ? 0.0 : 0.02, set ? 0.15 : 0.0, self->seed);
        riddle_plot_panel(figure, 2, set, "processor time of a fit [s]", "above the best deviation [-]");
        riddle_plot_title(figure, set ? "fits: part never passes" : "fits: curves of Subasinghe, noise 0.02");
        riddle_plot_log_x(figure);
        riddle_plot_log_y(figure);
        riddle_plot_range_y(figure, 3e-11, 1e-3);
        for (int m = 0; m < 3; m++) {
            static const int counts[] = {1, 2, 5, 10, 20};
            const int seeds = self->quick ? 1 : 6, n = self->quick ? 2 : 5;
            double best = HUGE_VAL, mean[5], seconds[5], deviation[6][5];
            screen_fit_result fit;
            for (int s = 0; s < seeds; s++)
                for (int k = 0; k < n; k++) {
                    screen_fit_options options = screen_default_fit_options((screen_model)m);
                    options.starts = counts[k];
                    options.seed = self->seed + 1000 * (uint64_t)s;
                    options.data_tolerance = 0.3;
                    double start = machine_processor_seconds();
                    if (screen_fit(&def, (screen_model)m, CASES, cases, &options, &fit)) {
                        common_fail("a fit of model %d failed", m);
                        return;
                    }
                    seconds[k] = s ? seconds[k] + (machine_processor_seconds() - start) / seeds
                                   : (machine_processor_seconds() - start) / seeds;
                    deviation[s][k] = fit.deviation;
                    best = fmin(best, fit.deviation);
                    if (common_interrupted()) return;
                }
            for (int k = 0; k < n; k++) {
                mean[k] = 1e-10; /* what is better than that is the same */
                for (int s = 0; s < seeds; s++) mean[k] += (deviation[s][k] - best) / seeds;
                csv_line(file, "%s,%d,%d,%.17g,%.17g,%.17g", set ? "stuck" : "noise", m, counts[k], best + mean[k],
                         mean[k], seconds[k]);
            }
            riddle_plot_line(figure, names[m], seconds, mean, n);
            riddle_plot_style(figure, RIDDLE_PLOT_MARKED, m);
            common_print("fit of %s to %s data: %d starts %.2f s, %.1e above the best of %d seeds (%.6f); all %d of %d "
                         "starts of the last "
                         "at its best\n",
                         names[m], set ? "stuck" : "noisy", counts[n - 1], seconds[n - 1], mean[n - 1], seeds, best,
                         fit.starts_at_best, fit.starts);
            if (m == 2) {
                json_number(report, set ? "fit_stuck_s" : "fit_noise_s", seconds[n - 1]);
                json_number(report, set ? "fit_stuck_above_best" : "fit_noise_above_best", mean[n - 1]);
            }
        }
    }
    riddle_io_close(file);
}

/* ---- 4: time a call ---- */

static void bench_calls(const program *self, json *report) {
    enum { MILLION = 1000000 };
    int n = self->quick ? MILLION / 5 : MILLION;
    double total = 0.0, start = machine_processor_seconds(), p[6], y[POINTS];
    for (int i = 0; i < n; i++) total += screen_subasinghe(0.3 + 1e-6 * i, 15.0, 0.5 + 1e-5 * i);
    double subasinghe = (machine_processor_seconds() - start) * MILLION / n;
    screen_def def = batch();
    screen_operation initial = {0.001, 50.6, 0.025, 0.0};
    double curve[4];
    for (int m = 0; m < 4; m++) {
        int rounds = (self->quick ? 1 : 5) * (m == 3 ? 200 : m == 1 ? 2000 : 10000);
        screen__set(p, 0.5, 1.0, 1.0, 0.0, 0.0, 0.0);
        if (m) screen_published((screen_model)m, p);
        start = machine_processor_seconds();
        for (int i = 0; i < rounds; i++) {
            initial.amplitude = 0.001 + 1e-9 * i;
            screen_predict(&def, (screen_model)m, p, &initial, TIMES, axis_t, y, NULL, NULL);
            total += y[0];
        }
        curve[m] = (machine_processor_seconds() - start) / rounds;
    }
    sink = total;
    common_print(
        "1e6 evaluations of model 2: %.4f s; a case of 80 points: model 0 %.1f us, 1 %.1f us, 2 %.1f us, 3 %.1f us\n",
        subasinghe, 1e6 * curve[0], 1e6 * curve[1], 1e6 * curve[2], 1e6 * curve[3]);
    json_number(report, "subasinghe_1e6_evaluations_s", subasinghe);
    json_number(report, "subasinghe_1e6_points_by_screen_predict_s", curve[2] * MILLION / POINTS);
    json_array(report, "case_of_80_points_s", curve, 4);
}

int main(int argc, char **argv) {
    program self =
        program_start("bench_screen_models", "Error against run time of screen_models.h.", NULL, 0, argc, argv);
    json *report = json_open(self.json);
    riddle_plot *figure = riddle_plot_new("screen_models.h: error against run time", 3, 2);
    bench_implicit(&self, figure, report);
    bench_soldinger(&self, figure, report);
    bench_fit(&self, figure, report);
    bench_calls(&self, report);
    json_program(report, &self);
    riddle_plot_write(figure, self.out, "screen_models_accuracy.svg");
    json_close(report);
    return common_exit_status();
}
