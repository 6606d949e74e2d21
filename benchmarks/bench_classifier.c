/* classifier.h: error against run time.

   1. T at 66.85 um (limestone, 3000 1/min, projected area): plain Monte Carlo, Sobol and rank-1 lattice points, with
      the restitution drawn and counted or integrated in closed form; root mean square error over many seeds, and how
      often the 95 % error bars hold the truth.
   2. The cut-size solver against the iteration x <- K c_D(a x) that the paper only calls "iteratively", and against the
      same with the geometric mean of old and new.
   3. Time a call of the laws. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "classifier.h"
#include "common.h"

enum { METHODS = 6, LEVELS = 6, RE_POINTS = 45 };

static const char *const method_names[METHODS] = {"Monte Carlo, counted", "Sobol, counted",
                                                  "lattice, counted",     "Monte Carlo, preintegrated",
                                                  "Sobol, preintegrated", "lattice, preintegrated (default)"};
static const char *const method_keys[METHODS] = {"mc_counted",       "sobol_counted",       "lattice_counted",
                                                 "mc_preintegrated", "sobol_preintegrated", "lattice_preintegrated"};
static const double size = 66.85e-6;

static classifier_def case_def(int method, int points, uint64_t seed) {
    classifier_def def = classifier_default_def();
    def.basis = CLASSIFIER_PROJECTED;
    def.sampler = (classifier_sampler)((2 - method % 3 + 3) % 3); /* the enum begins with the lattice */
    def.preintegrate = method >= 3;
    def.points = points / 8;
    def.seed = seed;
    return def;
}

/* T and its error bar from `points` in all; seconds of processor time with set-up */
static int one(int method, int points, uint64_t seed, double *t, double *bar, double *seconds) {
    classifier_def def = case_def(method, points, seed);
    classifier_model model;
    double began = machine_processor_seconds();
    classifier_status status = classifier_init(&model, &def, NULL);
    if (status != CLASSIFIER_OK) return common_fail("%s", classifier_status_text(status));
    *t = classifier_tromp(&model, size, bar);
    classifier_free(&model);
    *seconds = machine_processor_seconds() - began;
    return 0;
}

static void separation(const program *self, json *report) {
    double truth, bar, seconds, error[METHODS][LEVELS], time[METHODS][LEVELS];
    int levels = self->quick ? 4 : LEVELS, seeds = self->quick ? 12 : 40;
    progress bar_on_screen;
    /* Sobol: not the method it is to judge first. */
    if (one(4, self->quick ? 1 << 18 : 1 << 20, 12345, &truth, &bar, &seconds)) return;
    common_print("T(66.85 um) = %.6f +- %.6f\n\n", truth, bar);
    static const result_column columns[] = {{"method", NULL, "%s"},
                                            {NULL, "method", "%s"},
                                            {"points", "points", "%.0f"},
                                            {"rms_error", "rms error", "%.1e"},
                                            {"seconds", "time [ms]", "%.2f", 1e3},
                                            {"covered", "bars that hold [%]", "%.0f", 100.0}};
    result_table *t = RESULTS(columns);
    progress_begin(&bar_on_screen, "separation curve", levels * METHODS);
    json_number(report, "t_reference", truth);
    for (int level = 0; level < levels; level++) {
        int points = 256 << (2 * level);
        for (int method = 0; method < METHODS && !common_interrupted(); method++) {
            double squares = 0.0, spent = HUGE_VAL;
            int covered = 0, n = level > 3 ? seeds / 4 : seeds;
            for (int seed = 0; seed < n; seed++) {
                double share;
                if (one(method, points, self->seed + (uint64_t)seed, &share, &bar, &seconds)) return;
                squares += (share - truth) * (share - truth) / n;
                covered += fabs(share - truth) <= bar;
                if (seconds < spent) spent = seconds; /* the least disturbed one */
            }
            error[method][level] = sqrt(squares);
            time[method][level] = spent;
            results_row(t, TEXTS(method_keys[method], method_names[method]), points, sqrt(squares), spent,
                        (double)covered / n);
            progress_add(&bar_on_screen, 1.0);
        }
    }
    progress_end(&bar_on_screen);
    results_write(t, report, "separation", self->out, "separation.csv");
    results_free(t);
    if (common_interrupted()) return;
    riddle_plot *figure = riddle_plot_new("Separation curve: error against run time", 1, 1);
    riddle_plot_panel_size(figure, 560, 380);
    riddle_plot_panel(figure, 0, 0, "processor time for T at one size, set-up included [ms]",
                      "root mean square error of T [-]");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    for (int method = 0; method < METHODS; method++) {
        double ms[LEVELS];
        for (int i = 0; i < levels; i++) ms[i] = 1e3 * time[method][i];
        riddle_plot_line(figure, method_names[method], ms, error[method], levels);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED | (method < 3 ? RIDDLE_PLOT_DASHED : 0), method % 3);
    }
    riddle_plot_horizontal(figure, "aim: 1e-4", 1e-4);
    riddle_plot_legend_outside(figure);
    riddle_plot_write(figure, self->out, "separation.svg");
}

/* x <- K c_D(a x) in units of Re: steps to 1e-12; weight 1/2: geometric mean */
static int picard(classifier_drag drag, double g, double damping, int most) {
    double re = sqrt(g * drag.c1);
    for (int i = 1; i <= most; i++) {
        double next = g * classifier_drag_coefficient(drag, re);
        if (damping < 1.0) next = sqrt(re * next);
        if (fabs(next - re) <= 1e-12 * next) return i;
        re = next;
    }
    return most;
}

static volatile double sink;

static void solver(const program *self, json *report) {
    enum { MOST = 100000 };
    double re[RE_POINTS], steps[3][RE_POINTS], ns[3] = {0.0, 0.0, 0.0};
    classifier_drag drag = classifier_hoelzer_sommerfeld(0.85, CLASSIFIER_EQUIVALENT);
    riddle_io_table out = riddle_io_table_begin("Re|solver, steps|Picard, steps|damped Picard, steps");
    riddle_io_file *file = csv_open(self->out, "solver.csv", "re,solver_steps,picard_steps,damped_picard_steps");
    int worst = 0;
    for (int i = 0; i < RE_POINTS; i++) {
        re[i] = pow(10.0, -3.0 + 8.0 * i / (RE_POINTS - 1.0));
        double g = re[i] / classifier_drag_coefficient(drag, re[i]);
        int n;
        sink = classifier__solve_cut(drag, g, &n);
        if (n > worst) worst = n;
        steps[0][i] = n;
        steps[1][i] = picard(drag, g, 1.0, MOST);
        steps[2][i] = picard(drag, g, 0.5, MOST);
        csv_line(file, "%.6g,%g,%g,%g", re[i], steps[0][i], steps[1][i], steps[2][i]);
        if (i % 4) continue;
        riddle_io_table_cell(&out, "%.2e", re[i]);
        for (int k = 0; k < 3; k++) {
            if (steps[k][i] >= MOST) riddle_io_table_cell(&out, "%s", "> 100000");
            else riddle_io_table_cell(&out, "%.0f", steps[k][i]);
        }
    }
    riddle_io_close(file);
    common_print("\n");
    table_end(&out);
    /* the paper's range, Re 5 to 90: time for one cut size */
    int repeat = self->quick ? 20000 : 200000;
    for (int k = 0; k < 3; k++) {
        double began = machine_processor_seconds(), sum = 0.0;
        int n = k == 0 ? repeat : repeat / 10;
        for (int i = 0; i < n; i++) {
            double at = 5.0 + 85.0 * (i % 97) / 96.0, g = at * at / (drag.c1 + drag.c2 * sqrt(at) + drag.c3 * at);
            sum += k == 0 ? classifier__solve_cut(drag, g, NULL) : picard(drag, g, k == 1 ? 1.0 : 0.5, MOST);
        }
        sink = sum;
        ns[k] = 1e9 * (machine_processor_seconds() - began) / n;
    }
    common_print("\nCut size at Re 5 .. 90: %.0f ns; Picard %.0f ns, damped %.0f ns. At most %d steps over all Re.\n\n",
                 ns[0], ns[1], ns[2], worst);
    results_values(report, {"solver_most_steps", worst}, {"solver_ns", ns[0]}, {"picard_ns", ns[1]},
                   {"damped_picard_ns", ns[2]},
                   {"picard_steps_at_re_50", picard(drag, 50.0 / classifier_drag_coefficient(drag, 50.0), 1.0, MOST)});
    riddle_plot *figure = riddle_plot_new("Cut size: steps to 12 digits, sphericity 0.85", 1, 1);
    riddle_plot_panel(figure, 0, 0, "Reynolds number at the cut [-]", "steps [-]");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    riddle_plot_range_y(figure, 1.0, 2e5);
    riddle_plot_line(figure, "quartic by Newton (classifier.h)", re, steps[0], RE_POINTS);
    riddle_plot_line(figure, "Picard (gives up at 100000)", re, steps[1], RE_POINTS);
    riddle_plot_line(figure, "Picard, geometric mean", re, steps[2], RE_POINTS);
    riddle_plot_write(figure, self->out, "solver.svg");
}

/* One law over 4096 Reynolds numbers or shapes, nanoseconds a call: the best of several passes */
static double time_law(int law, int passes) {
    classifier_drag hs = classifier_hoelzer_sommerfeld(0.8, CLASSIFIER_EQUIVALENT), sn = classifier_schiller_naumann(),
                    st = classifier_stokes();
    static double re[4096];
    double best = HUGE_VAL;
    for (int i = 0; i < 4096; i++) re[i] = pow(10.0, -2.0 + 4.5 * i / 4095.0);
    for (int pass = 0; pass < passes; pass++) {
        double began = machine_processor_seconds(), sum = 0.0;
        for (int repeat = 0; repeat < 50; repeat++)
            for (int i = 0; i < 4096; i++) {
                double r = re[i];
                sum += law == 0   ? classifier_drag_coefficient(st, r)
                       : law == 1 ? classifier_drag_coefficient(hs, r)
                       : law == 2 ? classifier_drag_coefficient(sn, r)
                       : law == 3 ? classifier_hoelzer_sommerfeld(0.5 + 1e-3 * r, CLASSIFIER_EQUIVALENT).c3
                       : law == 4 ? classifier_di_felice_interstitial_total(0.9, r)
                       : law == 5 ? classifier_terminal_velocity(hs, 1e-6 * r, 2700.0, 1.2, 1.81e-5, 9.81)
                                  : classifier_stopping_distance(hs, 1e-5, 2700.0, 1.2, 1.81e-5, r);
            }
        sink = sum;
        double ns = 1e9 * (machine_processor_seconds() - began) / (50.0 * 4096.0);
        if (ns < best) best = ns;
    }
    return best;
}

static void laws(const program *self, json *report) {
    const char *const names[] = {"Stokes c_D",           "Hoelzer-Sommerfeld c_D (shape prepared)",
                                 "Schiller-Naumann c_D", "Hoelzer-Sommerfeld, preparing a shape",
                                 "Di Felice factor",     "terminal velocity",
                                 "stopping distance"};
    const char *const keys[] = {
        "stokes_ns",    "hoelzer_sommerfeld_ns", "schiller_naumann_ns", "hoelzer_sommerfeld_shape_ns",
        "di_felice_ns", "terminal_velocity_ns",  "stopping_distance_ns"};
    static const result_column columns[] = {{"law", "law", "%s"}, {"ns", "ns a call", "%.1f"}};
    result_table *t = RESULTS(columns);
    for (int law = 0; law < 7; law++) {
        double ns = time_law(law, self->quick ? 2 : 7);
        results_row(t, TEXTS(names[law]), ns);
        json_number(report, keys[law], ns);
    }
    results_print(t);
    results_csv(t, self->out, "laws.csv");
    results_free(t);
}

int main(int argc, char **argv) {
    program self =
        program_start("bench_classifier", "Separation curve, cut-size solver and drag laws: error against run time.",
                      NULL, 0, argc, argv);
    json *report = json_open(self.json);
    separation(&self, report);
    solver(&self, report);
    laws(&self, report);
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
