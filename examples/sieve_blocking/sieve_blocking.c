/* Sieve-hole blocking by blocking.h, after Lawinska, Modrzewski & Wodzinski, Granular Matter 18 (2016) 13, "the paper".

   1. table2.svg: the exponentials of Table 2, experiment beside model.
   2. fit.svg: rate constants from counted holes. Without --data the readings are drawn from a row of Table 2 with the
      counting noise of four templates of 100 holes, at the paper's times 0, 1, 2, 4 ... 2048 s: the paper does not
      print its raw counts.
   3. polynomials.svg: mean free fraction f*(K, x_h) of Table 3, limited to 1.
   4. deck.svg: the deck area for a duty, from the fitted curve and from Table 3.

   The process itself: sieve_blocking --simulate --k 1.5 --xh 0.65  counts the holes of a periodic patch of a vibrated
   sieve by dem.h, of
                                                             spheres, and fits those; --sweep: five K and three x_h
                                                             beside Table 3
   Your own counts:   sieve_blocking --data counts.csv       columns time_s,free_holes,holes (one row a template, in
                                                             any order; rows of one time are added up) or
                                                             time_s,free_fraction
   Your own tests:    sieve_blocking --tests tests.csv       columns test,time_s,K,x_h,moisture and counts: laws for k1
                      and k2
   Your own grains:   sieve_blocking --sizes sieve.csv       columns size_mm,passing (fraction finer, 0..1): gives x_h
                      for --opening-mm
   Your own machine:  --frequency-hz 23.3 --amplitude-mm 0.7 --slope-deg 15, or --k 1.5 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "blocking.h"
#include "blocking_tests.h"
#include "common.h"
#include "sieve_continuous.h"

enum { MOST_READINGS = 200, GRID = 61, CURVE = 241 };

static const double z95 = 1.96;

/* ---- Table 2 ---- */

typedef struct row {
    const char *figure, *what;
    double f_inf, A, k; /* f = f_inf + A exp(-k t); [-] [-] [1/s] */
} row;

static const row table2[] = {
    {"7a", "experiment", .960, .0209, .0421},  {"7a", "model", .961, .0210, .0353},
    {"7b", "experiment", .714, .235, .0101},   {"7b", "model", .704, .257, .00667},
    {"8a", "experiment", .909, -.214, .0234},  {"8a", "model", .932, -.301, .0433},
    {"8b", "experiment", .960, -.0907, .0119}, {"8b", "model", .965, -.072, .0197},
};
static const char *const titles[] = {"Fig 7a: spherical, 1 mm, K = 1.5", "Fig 7b: spherical, 1 mm, K = 3.5",
                                     "Fig 8a: irregular, 0.5 mm, K = 1.5", "Fig 8b: irregular, 0.5 mm, K = 3.5"};

static double at(const row *r, double t) { return blocking_curve(r->f_inf + r->A, r->f_inf, r->k, t); }

static void draw_table2(const program *self, json *report) {
    riddle_plot *figure = riddle_plot_new("Free holes in time, Table 2 of Lawinska et al. (2016)", 2, 2);
    riddle_io_file *file = csv_open(self->out, "table2.csv",
                                    "time_s,f_7a_experiment,f_7a_model,f_7b_experiment,f_7b_model,f_8a_experiment,f_8a_"
                                    "model,f_8b_experiment,f_8b_model");
    static const result_column columns[] = {{"figure", NULL, "%s"},        {"row", NULL, "%s"},
                                            {NULL, "Table 2", "%s"},       {"f0", "f(0)", "%.4f"},
                                            {"f_inf", "f_inf", "%.3f"},    {"k_per_s"},
                                            {"f_30_s", "f(30 s)", "%.4f"}, {"mean_60_s", "mean of 60 s", "%.4f"},
                                            {NULL, "k1 [1/s]", "%.5f"},    {NULL, "k2 [1/s]", "%.5f"},
                                            {"largest_difference"},        {NULL, "largest difference", "%s"}};
    result_table *t = RESULTS(columns);
    double time[CURVE], f[8][CURVE];
    for (int i = 0; i < CURVE; i++) {
        double line[9] = {time[i] = 300.0 * i / (CURVE - 1)};
        for (int j = 0; j < 8; j++) line[j + 1] = f[j][i] = at(&table2[j], time[i]);
        riddle_io_row(file, line, 9);
    }
    for (int j = 0; j < 8; j++) {
        const row *r = &table2[j], *other = &table2[j ^ 1];
        double f0 = r->f_inf + r->A, difference = 0.0, when = 0.0;
        for (double s = 0.0; s <= 2048.0; s += 1.0)
            if (fabs(at(r, s) - at(other, s)) > difference) {
                difference = fabs(at(r, s) - at(other, s));
                when = s;
            }
        char name[60], most[60] = "";
        snprintf(name, sizeof name, "%s %s", r->figure, r->what);
        if (j % 2 == 0) snprintf(most, sizeof most, "%.4f at %.0f s", difference, when);
        results_row(t, TEXTS(r->figure, r->what, name, most), f0, r->f_inf, r->k, at(r, 30.0),
                    blocking_time_mean(f0, r->f_inf, r->k, 60.0), blocking_k1(r->f_inf, r->k),
                    blocking_k2(r->f_inf, r->k), difference);
        if (j % 2 == 0) {
            riddle_plot_panel(figure, j / 4, j / 2 % 2, "time [s]", "free holes f [-]");
            riddle_plot_title(figure, titles[j / 2]);
        }
        riddle_plot_line(figure, r->what, time, f[j], CURVE);
        if (j % 2) riddle_plot_style(figure, RIDDLE_PLOT_DASHED, RIDDLE_PLOT_NEXT);
    }
    results_print(t);
    results_json(t, report, "table2");
    results_free(t);
    riddle_io_close(file);
    riddle_plot_write(figure, self->out, "table2.svg");
}

/* ---- readings ---- */

static const char *const counts_file = "a file with the columns time_s,free_holes,holes or time_s,free_fraction";
static const char *const sizes_file = "a sieve curve about the opening";

typedef struct readings {
    double t[MOST_READINGS], f[MOST_READINGS], sigma[MOST_READINGS];
    double free_holes[MOST_READINGS], holes[MOST_READINGS];
    int n, counted; /* counted: sigma comes from numbers of holes */
} readings;

static void draw_readings(readings *r, const row *from, int holes, uint64_t seed) {
    r->n = 0;
    r->counted = 1;
    for (double t = 0.0; t <= 2048.0; t = t > 0.0 ? 2.0 * t : 1.0) {
        int count = 0;
        for (int i = 0; i < holes; i++) count += random_share(&seed) < at(from, t);
        r->t[r->n] = t;
        r->free_holes[r->n] = count;
        r->holes[r->n] = holes;
        r->n++;
    }
}

/* Returns the place of the reading at time t [s], which it makes if there is none: sheets may list one template after
   the other. -1: no room. */
static int reading_at(readings *r, double t) {
    int k = 0;
    while (k < r->n && r->t[k] < t) k++;
    if (k < r->n && r->t[k] == t) return k;
    if (r->n == MOST_READINGS) return -1;
    for (int m = r->n++; m > k; m--)
        r->t[m] = r->t[m - 1], r->free_holes[m] = r->free_holes[m - 1], r->holes[m] = r->holes[m - 1];
    r->t[k] = t, r->free_holes[k] = r->holes[k] = 0.0;
    return k;
}

static void read_readings(const program *self, const char *path, readings *r) {
    enum { TIME, FREE, HOLES, FRACTION, COLUMNS };
    sheet data;
    char message[600];
    sheet_column c[COLUMNS] = {sheet_want("time", 'T', true), sheet_want("free_holes", '#', false),
                               sheet_want("holes", '#', false), sheet_want("free_fraction", '%', false)};
    if (sheet_read(path, c, COLUMNS, &data, message, sizeof message) != 0) program_refuse(self, "data", path, message);
    r->counted = c[FREE].value && c[HOLES].value;
    if (!r->counted && !c[FRACTION].value) program_refuse(self, "data", path, counts_file);
    common_print("%s\n", data.how);
    r->n = 0;
    for (int i = 0; i < data.rows; i++) {
        const int k = reading_at(r, c[TIME].value[i]);
        if (k < 0) program_refuse(self, "data", path, "a file with at most 200 different times");
        r->free_holes[k] += r->counted ? c[FREE].value[i] : c[FRACTION].value[i];
        r->holes[k] += r->counted ? c[HOLES].value[i] : 1.0;
        if (r->counted && !(r->holes[k] > 0.0 && r->free_holes[k] <= r->holes[k]))
            refuse_file(self, "data", path, counts_file, blocking_status_text(BLOCKING_BAD_COUNT));
        if (r->counted &&
            !(c[FREE].value[i] == floor(c[FREE].value[i]) && c[HOLES].value[i] == floor(c[HOLES].value[i])))
            refuse_file(self, "data", path, counts_file,
                        "holes are counted in whole numbers; means of several counts go in as fractions");
    }
    sheet_free(&data);
}

/* ---- rate constants ---- */

static blocking_status fit_readings(readings *r, blocking_fit_result *fit) {
    blocking_fit_def def = blocking_default_fit_def();
    def.z = z95;
    if (r->counted) return fit_counts(&def, r->t, r->free_holes, r->holes, (size_t)r->n, r->f, r->sigma, fit);
    for (int i = 0; i < r->n; i++) r->f[i] = r->free_holes[i] / r->holes[i];
    return blocking_fit(&def, r->t, r->f, NULL, (size_t)r->n, fit);
}

static void report_fit(json *report, const readings *r, blocking_status status, const blocking_fit_result *fit,
                       const char *source) {
    common_print("\nReadings: %s, %d times\nLeast squares: %s\n", source, r->n, blocking_status_text(status));
    common_print("  f0 %.4f, f_inf %.4f, k %.5f 1/s, R2 %.3f; k1 %.5f 1/s (blocking), k2 %.5f 1/s (unblocking)\n",
                 fit->f0, fit->f_inf, fit->k, fit->r2, fit->k1, fit->k2);
    common_print("  95 %% ranges, %s: f0 %.4f .. %.4f, f_inf %.4f .. %.4f%s, k %.5f .. %.5f 1/s%s\n",
                 r->counted ? "errors from the numbers of holes" : "errors from the scatter about the curve",
                 fit->f0_lowest, fit->f0_highest, fit->f_inf_lowest, fit->f_inf_highest,
                 fit->f_inf_determined ? "" : " (not determined)", fit->k_lowest, fit->k_highest,
                 fit->k_determined ? "" : " (not determined)");
    json_object_begin(report, "fit");
    json_string(report, "source", source);
    json_string(report, "status", blocking_status_text(status));
    results_values(report, {"readings", r->n}, {"f0", fit->f0}, {"f_inf", fit->f_inf}, {"k_per_s", fit->k},
                   {"k1_per_s", fit->k1}, {"k2_per_s", fit->k2}, {"error_f0", fit->error_f0},
                   {"error_f_inf", fit->error_f_inf}, {"error_k_per_s", fit->error_k},
                   {"k_lowest_per_s", fit->k_lowest}, {"k_highest_per_s", fit->k_highest},
                   {"f0_lowest", fit->f0_lowest}, {"f0_highest", fit->f0_highest}, {"f_inf_lowest", fit->f_inf_lowest},
                   {"f_inf_highest", fit->f_inf_highest}, {"degrees_of_freedom", fit->dof});
    json_bool(report, "k_determined", fit->k_determined);
    json_bool(report, "f_inf_determined", fit->f_inf_determined);
    json_number(report, "r2", fit->r2);
    json_number(report, "mean_60_s", blocking_time_mean(fit->f0, fit->f_inf, fit->k, 60.0));
    json_object_end(report);
}

/* Every pair of readings at t and 2 t with the one at 0 (or the first reading, for other times): what eq 14 and 15
   would be asked. */
static int three_points(json *report, const readings *r, double *first, double *k, double *error) {
    int found = 0;
    static const result_column columns[] = {{NULL, "three readings [s]", "%s"},     {NULL, "f_inf", "%.3f"},
                                            {NULL, "standard error of it", "%.3f"}, {NULL, "k [1/s]", "%.4f"},
                                            {NULL, "standard error of it", "%.4f"}, {NULL, "status", "%s"}};
    result_table *t = RESULTS(columns);
    json_array_begin(report, "three_point");
    for (int i = 1; i + 1 < r->n; i++) {
        const double times[3] = {r->t[0], r->t[i], r->t[i + 1]}, f[3] = {r->f[0], r->f[i], r->f[i + 1]};
        double sigma =
            r->counted
                ? sqrt((r->sigma[0] * r->sigma[0] + r->sigma[i] * r->sigma[i] + r->sigma[i + 1] * r->sigma[i + 1]) /
                       3.0)
                : 0.0;
        blocking_estimate e;
        blocking_status status = blocking_three_point(times, f, sigma, BLOCKING_TOLERANCE, &e);
        char text[100];
        snprintf(text, sizeof text, "%g, %g, %g", times[0], times[1], times[2]);
        results_row(t, TEXTS(text, blocking_status_text(status)), e.f_inf, e.error_f_inf, e.k, e.error_k);
        json_object_begin(report, NULL);
        json_array(report, "time_s", times, 3);
        results_values(report, {"f_inf", e.f_inf}, {"k_per_s", e.k}, {"error_k_per_s", e.error_k});
        json_string(report, "status", blocking_status_text(status));
        json_object_end(report);
        if (!(e.k > 0.0)) continue;
        first[found] = times[1];
        k[found] = e.k;
        error[found] = e.error_k;
        found++;
    }
    json_array_end(report);
    results_print(t);
    results_free(t);
    return found;
}

/* ---- many tests ---- */

/* k1 and k2 as laws of K, x_h and moisture from the curves of a file; what they say at K and x_h, in the report
   and as a duty. */
static void fit_tests(const program *self, json *report, const char *path, double K, double x_h, blocking_duty *duty) {
    blocking_law law;
    blocking_law_value at_yours;
    blocking_law_run run;
    read_blocking_law(self, path, &law);
    blocking_law_at(&law, K, x_h, 0.0, &at_yours);
    blocking_law_free(&law, K, x_h, 0.0, duty->f0, duty->run_time, &run);
    duty->f_inf = at_yours.f_inf;
    duty->k = at_yours.k1 + at_yours.k2;
    duty->last_lowest = run.last_low95, duty->last_highest = run.last_high95;
    duty->mean_lowest = run.mean_low95, duty->mean_highest = run.mean_high95;
    common_print("%s: %d tests, %d readings; the form with the lowest AICc (%.1f; constant k1 and k2: %.1f)\n", path,
                 (int)law.tests, (int)law.readings, law.aicc, law.aicc_constant);
    common_print(
        "  ln k1 = %.4g + %.4g K + %.4g x_h + %.4g moisture\n  ln k2 = %.4g + %.4g K + %.4g x_h + %.4g moisture\n",
        law.a[0], law.a[1], law.a[2], law.a[3], law.b[0], law.b[1], law.b[2], law.b[3]);
    common_print("At K %.3g, x_h %.3g, dry%s: k1 %.4g (95 %% range %.4g .. %.4g) 1/s, k2 %.4g (%.4g .. %.4g) 1/s, "
                 "f_inf %.3f (%.3f .. %.3f)\n",
                 K, x_h, at_yours.outside ? ", OUTSIDE the tests" : "", at_yours.k1, at_yours.k1_low95,
                 at_yours.k1_high95, at_yours.k2, at_yours.k2_low95, at_yours.k2_high95, at_yours.f_inf,
                 at_yours.f_inf_low95, at_yours.f_inf_high95);
    common_print("A deck that was just cleaned, after %.3g s: f %.3f (%.3f .. %.3f), mean %.3f (%.3f .. %.3f)\n",
                 duty->run_time, run.last, run.last_low95, run.last_high95, run.mean, run.mean_low95, run.mean_high95);
    json_object_begin(report, "law");
    results_values(report, {"tests", (int)law.tests}, {"aicc", law.aicc}, {"aicc_constant", law.aicc_constant});
    json_array(report, "ln_k1_of_1_K_x_h_moisture", law.a, BLOCKING_LAW_TERMS);
    json_array(report, "ln_k2_of_1_K_x_h_moisture", law.b, BLOCKING_LAW_TERMS);
    results_values(report, {"K", K}, {"x_h", x_h}, {"k1_per_s", at_yours.k1}, {"k2_per_s", at_yours.k2},
                   {"f_inf", at_yours.f_inf}, {"f_inf_low95", at_yours.f_inf_low95},
                   {"f_inf_high95", at_yours.f_inf_high95}, {"free_mean", run.mean},
                   {"free_mean_low95", run.mean_low95}, {"free_mean_high95", run.mean_high95});
    json_bool(report, "extrapolated", at_yours.outside != 0);
    json_object_end(report);
}

/* ---- simulation ---- */

/* Counts at 0 s and, doubling from 1 s (or an eighth of a shorter time), up to `time`, each to whole periods of the
   deck. 0, or -1 after one line on stderr or Ctrl-C. */
static int simulate(const sieve_patch_def *def, double time, readings *r, sieve_patch *patch, progress *bar) {
    const int holes = def->across * def->across, last = (int)(time * def->frequency + 0.5);
    int next = (int)(fmin(1.0, 0.125 * time) * def->frequency + 0.5);
    dem_status status = sieve_patch_make(patch, def);
    if (status == DEM_OK) status = sieve_patch_lay(patch);
    r->n = 0;
    r->counted = 1;
    for (int period = 0; status == DEM_OK && !common_interrupted(); period++) {
        if (period == 0 || period == next) {
            const int blocked = sieve_patch_blocked(patch);
            if (blocked < 0) status = DEM_OUT_OF_MEMORY;
            r->t[r->n] = period / def->frequency;
            r->free_holes[r->n] = holes - blocked;
            r->holes[r->n++] = holes;
            if (period == next) next *= 2;
        }
        if (period == last || next > last) break;
        if (status == DEM_OK) status = sieve_patch_vibrate(patch, 1);
        progress_add(bar, 1.0 / def->frequency);
    }
    if (status != DEM_OK) common_fail("simulation at K %g, x_h %g: %s", def->K, def->x_h, dem_status_text(status));
    return status != DEM_OK || common_interrupted() ? -1 : 0;
}

static void report_simulation(json *report, const sieve_patch *patch, const readings *r) {
    const sieve_patch_def *def = &patch->def;
    const dem_world *w = &patch->world;
    ptrdiff_t too_large = patch->forced;
    for (ptrdiff_t i = 0; i < w->passed_count; i++) too_large += w->passed[i].diameter > def->opening;
    common_print("Simulated: %d x %d holes of %g mm, wires of %g mm, vertical amplitude %.3f mm at %.4g Hz, %ld "
                 "spheres of %.2f .. %.2f mm "
                 "(%.3g kg/m2, x_h %.3f)\n",
                 def->across, def->across, 1e3 * def->opening, 1e3 * def->wire, 1e3 * sieve_patch_amplitude(def),
                 def->frequency, (long)patch->grains, 500.0 * def->opening, 1600.0 * def->opening, def->load,
                 patch->hard_mass / patch->mass);
    common_print("  %ld of them passed, %ld larger than a hole were forced through; steps of %.2g s at the end\n",
                 (long)w->passed_total, (long)too_large, w->def.dt);
    json_object_begin(report, "simulation");
    results_values(report, {"holes", def->across * def->across}, {"opening_m", def->opening}, {"wire_m", def->wire},
                   {"K", def->K}, {"frequency_hz", def->frequency}, {"amplitude_m", sieve_patch_amplitude(def)},
                   {"x_h", patch->hard_mass / patch->mass}, {"load_kg_per_m2", def->load},
                   {"spheres", (double)patch->grains}, {"passed", (double)w->passed_total},
                   {"forced_through", (double)too_large}, {"vibrated_s", r->t[r->n - 1]},
                   {"contact_steps", (double)w->contact_steps});
    json_array(report, "time_s", r->t, r->n);
    json_array(report, "free_holes", r->free_holes, r->n);
    json_object_end(report);
}

enum { KS = 5, XS = 3 };
static const double sweep_K[KS] = {0.62, 1.5, 1.98, 3.5, 4.9}, sweep_x_h[XS] = {0.3, 0.65, 0.9};

typedef struct sweep_jobs {
    sieve_patch_def def;
    double time;
    progress bar;
    readings r[KS * XS];
} sweep_jobs;

static int sweep_one(int index, void *user) {
    sweep_jobs *jobs = user;
    sieve_patch_def def = jobs->def;
    sieve_patch patch;
    def.K = sweep_K[index % KS];
    def.x_h = sweep_x_h[index / KS];
    const int failed = simulate(&def, jobs->time, &jobs->r[index], &patch, &jobs->bar);
    dem_free(&patch.world);
    return failed;
}

/* Five K and three x_h beside Table 3: f* is the mean of f0 and f_inf there (section 4). */
static void sweep(const program *self, json *report, const sieve_patch_def *def, double time) {
    static const char *const names[XS] = {"30 % hard to screen (x_h = 0.30)", "65 % (x_h = 0.65)", "90 % (x_h = 0.90)"};
    static sweep_jobs jobs;
    jobs.def = *def, jobs.time = time;
    progress_begin(&jobs.bar, "sweep", KS * XS * time);
    const int failed = jobs_run(KS * XS, self->threads, sweep_one, &jobs);
    progress_end(&jobs.bar);
    if (failed) return;
    double mean[XS][KS], bar_of[XS][KS], table3[XS][GRID], at_K[GRID];
    riddle_plot *figure = riddle_plot_new(
        "Blocking by spheres, simulated, beside Table 3 of Lawinska et al. (2016); K: toss indicator", 2, 2);
    static const result_column columns[] = {{NULL, "K", "%g"},
                                            {NULL, "x_h", "%g"},
                                            {NULL, "f0", "%.3f"},
                                            {NULL, "f at the end", "%.3f"},
                                            {NULL, "f0 fitted", "%.3f"},
                                            {NULL, "f_inf fitted", "%.3f"},
                                            {NULL, "k1 [1/s]", "%.3f"},
                                            {NULL, "k2 [1/s]", "%.3f"},
                                            {NULL, "R2", "%.3f"},
                                            {NULL, "f* +- 95 % by counting holes", "%s"},
                                            {NULL, "f* of Table 3", "%.3f"},
                                            {NULL, "fit", "%s"}};
    result_table *counts = results_of("K,x_h,time_s,free_holes,holes"), *t = RESULTS(columns);
    json_array_begin(report, "sweep");
    for (int j = 0; j < XS; j++) {
        riddle_plot_panel(figure, j / 2, j % 2, "time [s]", "free holes f [-]");
        riddle_plot_title(figure, names[j]);
        for (int i = 0; i < KS; i++) {
            readings *r = &jobs.r[j * KS + i];
            const int last = r->n - 1;
            const double K = sweep_K[i], x_h = sweep_x_h[j],
                         of_table = fmin(1.0, blocking_table3(BLOCKING_SPHERICAL, K, x_h));
            blocking_fit_result fit;
            const blocking_status status = fit_readings(r, &fit);
            char label[40];
            snprintf(label, sizeof label, "K = %g", K);
            riddle_plot_line(figure, label, r->t, r->f, r->n);
            riddle_plot_style(figure, RIDDLE_PLOT_MARKED, i);
            mean[j][i] = 0.5 * (r->f[0] + r->f[last]);
            bar_of[j][i] = 0.5 * z95 * sqrt(r->sigma[0] * r->sigma[0] + r->sigma[last] * r->sigma[last]);
            for (int q = 0; q < r->n; q++) results_row(counts, NULL, K, x_h, r->t[q], r->free_holes[q], r->holes[q]);
            snprintf(label, sizeof label, "%.3f +- %.3f", mean[j][i], bar_of[j][i]);
            results_row(t, TEXTS(label, blocking_status_text(status)), K, x_h, r->f[0], r->f[last], fit.f0, fit.f_inf,
                        fit.k1, fit.k2, fit.r2, of_table);
            json_object_begin(report, NULL);
            json_number(report, "K", K);
            json_number(report, "x_h", x_h);
            json_array(report, "time_s", r->t, r->n);
            json_array(report, "free_fraction", r->f, r->n);
            results_values(report, {"f_star", mean[j][i]}, {"f_star_table3", of_table}, {"f0_fitted", fit.f0},
                           {"f_inf_fitted", fit.f_inf}, {"k1_per_s", fit.k1}, {"k2_per_s", fit.k2}, {"r2", fit.r2});
            json_object_end(report);
        }
    }
    json_array_end(report);
    results_print(t);
    results_csv(counts, self->out, "sweep.csv");
    results_free(t);
    results_free(counts);
    riddle_plot_panel(figure, 1, 1, "toss indicator K [-]", "f*: mean of f at 0 s and at the end [-]");
    riddle_plot_title(figure, "beside Table 3, spherical (lines)");
    for (int i = 0; i < GRID; i++) at_K[i] = 0.6 + 4.3 * i / (GRID - 1);
    for (int j = 0; j < XS; j++) {
        for (int i = 0; i < GRID; i++)
            table3[j][i] = fmin(1.0, blocking_table3(BLOCKING_SPHERICAL, at_K[i], sweep_x_h[j]));
        riddle_plot_error_bars(figure, names[j], sweep_K, mean[j], bar_of[j], KS);
        riddle_plot_style(figure, 0, j);
        riddle_plot_line(figure, NULL, at_K, table3[j], GRID);
        riddle_plot_style(figure, RIDDLE_PLOT_DASHED, j);
    }
    riddle_plot_write(figure, self->out, "sweep.svg");
}

/* from: the row of Table 2 that the readings were drawn from, or NULL */
static void draw_fit(const program *self, json *report, const readings *r, const blocking_fit_result *fit,
                     const char *source, const row *from) {
    double first[MOST_READINGS], k[MOST_READINGS], error[MOST_READINGS], bar[MOST_READINGS], t[CURVE], f[CURVE],
        origin[CURVE];
    int found = three_points(report, r, first, k, error);
    double last = r->t[r->n - 1], shown = fit->k > 0.0 && 8.0 / fit->k < last ? 8.0 / fit->k : last;
    for (int i = 0; i < CURVE; i++) {
        t[i] = shown * i / (CURVE - 1);
        f[i] = fit->k > 0.0 ? blocking_curve(fit->f0, fit->f_inf, fit->k, t[i]) : fit->f_inf;
        if (from) origin[i] = at(from, t[i]);
    }
    for (int i = 0; i < r->n; i++) bar[i] = r->counted ? z95 * r->sigma[i] : 0.0;
    char title[200];
    snprintf(title, sizeof title, "Rate constants from counted holes: %s", source);
    riddle_plot *figure = riddle_plot_new(title, 1, 2);
    riddle_plot_panel(figure, 0, 0, "time [s]", "free holes f [-]");
    riddle_plot_range_x(figure, -0.03 * shown, 1.03 * shown);
    riddle_plot_line(figure, "least squares", t, f, CURVE);
    if (from) {
        riddle_plot_line(figure, "Table 2", t, origin, CURVE);
        riddle_plot_style(figure, RIDDLE_PLOT_DASHED | RIDDLE_PLOT_THIN, RIDDLE_PLOT_BLACK);
    }
    if (r->counted) riddle_plot_error_bars(figure, "readings, 95 %", r->t, r->f, bar, r->n);
    else riddle_plot_points(figure, "readings", r->t, r->f, r->n);
    riddle_plot_panel(figure, 0, 1, "second reading at [s]", "k [1/s]");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    /* Down to a twentieth on the log axis. */
    for (int i = 0; i < found; i++) error[i] = fmin(z95 * error[i], 0.95 * k[i]);
    if (found && r->counted) riddle_plot_error_bars(figure, "three readings, 95 %", first, k, error, found);
    else if (found) riddle_plot_points(figure, "three readings", first, k, found);
    if (fit->k > 0.0) {
        const double over[2] = {r->t[1] > 0.0 ? r->t[1] : 1.0, last}, fitted[2] = {fit->k, fit->k};
        riddle_plot_line(figure, "least squares", over, fitted, 2);
        riddle_plot_style(figure, RIDDLE_PLOT_DASHED, RIDDLE_PLOT_BLACK);
        if (fit->k_lowest > 0.0 && fit->k_highest < 1e300) {
            double ends[2] = {r->t[1] > 0.0 ? r->t[1] : 1.0, last}, low[2] = {fit->k_lowest, fit->k_lowest},
                   high[2] = {fit->k_highest, fit->k_highest};
            riddle_plot_band(figure, "least squares, 95 %", ends, low, high, 2);
        }
    }
    riddle_plot_write(figure, self->out, "fit.svg");
    result_table *file = results_of("time_s,free_fraction,standard_error,fitted");
    for (int i = 0; i < r->n; i++)
        results_row(file, NULL, r->t[i], r->f[i], r->counted ? r->sigma[i] : (double)NAN,
                    blocking_curve(fit->f0, fit->f_inf, fit->k, r->t[i]));
    results_csv(file, self->out, "fit.csv");
    results_free(file);
}

/* ---- Table 3 ---- */

/* Pieces of the line raw = 1 on the grid, each two points and a gap: where the sign of raw - 1 changes along the
   sides of a cell. */
static int contour_of_one(const double *raw, double *x, double *y, int most) {
    int n = 0;
    for (int j = 0; j + 1 < GRID; j++)
        for (int i = 0; i + 1 < GRID; i++) {
            const int corner[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
            int crossings = 0;
            for (int side = 0; side < 4 && n + 3 <= most; side++) {
                const int *p = corner[side], *q = corner[side + 1];
                double a = raw[(j + p[1]) * GRID + i + p[0]] - 1.0, b = raw[(j + q[1]) * GRID + i + q[0]] - 1.0;
                if ((a > 0.0) == (b > 0.0)) continue;
                double share = a / (a - b);
                x[n] = 0.6 + 4.4 * (i + p[0] + share * (q[0] - p[0])) / (GRID - 1);
                y[n] = (j + p[1] + share * (q[1] - p[1])) / (GRID - 1);
                n++;
                if (++crossings % 2 == 0) {
                    x[n] = y[n] = (double)NAN;
                    n++;
                }
            }
        }
    return n;
}

static void draw_polynomials(const program *self, json *report, double K, double x_h) {
    static double raw[GRID * GRID], cut[GRID * GRID], x[8 * GRID * 3], y[8 * GRID * 3];
    riddle_plot *figure = riddle_plot_new("Mean free fraction f* of Table 3, cut to 1 beyond the line", 2, 2);
    riddle_io_file *file =
        csv_open(self->out, "polynomials.csv", "K,x_h,spherical,irregular,sharp_as_printed,sharp_repaired");
    static const result_column columns[] = {{"shape", "Table 3, K 0.6-5", "%s"},
                                            {"least", "least", "%.4f"},
                                            {"largest", "largest", "%.4f"},
                                            {"share_above_one", "above 1 [%]", "%.1f", 100.0},
                                            {NULL, "rising with x_h [%]", "%.1f", 100.0},
                                            {"f_star", "f* at your K, x_h", "%.4f"},
                                            {"f_star_raw"},
                                            {"flags"},
                                            {"remark", "remark", "%s"}};
    result_table *t = RESULTS(columns);
    blocking_conditions c = blocking_default_conditions();
    c.K = K;
    c.x_h = x_h;
    json_object_begin(report, "polynomial");
    json_number(report, "K", K);
    json_number(report, "x_h", x_h);
    for (int s = 0; s < BLOCKING_SHAPE_COUNT; s++) {
        blocking_shape shape = (blocking_shape)s;
        for (int j = 0; j < GRID; j++)
            for (int i = 0; i < GRID; i++) {
                double f = blocking_table3(shape, 0.6 + 4.4 * i / (GRID - 1), (double)j / (GRID - 1));
                raw[j * GRID + i] = f;
                cut[j * GRID + i] = fmin(f, 1.0);
            }
        double least = HUGE_VAL, largest = -HUGE_VAL, above = 0.0, rising = 0.0;
        const int n = 400;
        for (int j = 0; j <= n; j++)
            for (int i = 0; i <= n; i++) {
                double K_ = 0.6 + 4.4 * i / n, h = (double)j / n, f = blocking_table3(shape, K_, h);
                double area = (i % n ? 1.0 : 0.5) * (j % n ? 1.0 : 0.5) / n / n;
                least = fmin(least, f);
                largest = fmax(largest, f);
                if (f > 1.0) above += area;
                if (blocking_table3_slope(shape, K_, h) > 0.0) rising += area;
            }
        blocking_average a;
        blocking_status status = blocking_average_free(shape, &c, &a);
        const char *remark = status == BLOCKING_OK ? "" : blocking_status_text(status);
        for (unsigned flag = 1; flag <= BLOCKING_FLAG_RISING && !*remark; flag *= 2)
            if (a.flags & flag) remark = blocking_flag_text(flag);
        results_row(t, TEXTS(blocking_shape_text(shape), remark), least, largest, above, rising, a.value, a.raw,
                    a.flags);
        riddle_plot_panel(figure, s / 2, s % 2, "toss indicator K [-]", "hard-to-screen content x_h [-]");
        riddle_plot_title(figure, blocking_shape_text(shape));
        riddle_plot_heat(figure, "f* [-]", cut, GRID, GRID, 0.6, 5.0, 0.0, 1.0);
        riddle_plot_heat_range(figure, 0.5, 1.0);
        riddle_plot_line(figure, "cubic = 1", x, y, contour_of_one(raw, x, y, (int)(sizeof x / sizeof *x)));
        riddle_plot_style(figure, 0, RIDDLE_PLOT_BLACK);
        if (K >= 0.6 && K <= 5.0) {
            riddle_plot_points(figure, a.flags & BLOCKING_FLAG_BOX ? "yours, outside the measured" : "yours", &K, &x_h,
                               1);
            riddle_plot_style(figure, 0, 1);
        }
    }
    results_json(t, report, "shapes");
    json_object_end(report);
    common_print("\n");
    results_print(t);
    results_free(t);
    for (int j = 0; j < GRID; j += 3)
        for (int i = 0; i < GRID; i += 3) {
            double k = 0.6 + 4.4 * i / (GRID - 1), h = (double)j / (GRID - 1), line[6] = {k, h};
            for (int s = 0; s < BLOCKING_SHAPE_COUNT; s++) line[2 + s] = blocking_table3((blocking_shape)s, k, h);
            riddle_io_row(file, line, 6);
        }
    riddle_io_close(file);
    riddle_plot_write(figure, self->out, "polynomials.svg");
}

/* ---- deck ---- */

static void design(const program *self, json *report, blocking_duty duty, const blocking_average *average,
                   blocking_shape shape) {
    blocking_deck deck;
    const char *field;
    if (blocking_check_duty(&duty, &field) != BLOCKING_OK) {
        common_fail("no deck is designed: the fit leaves %s open", field);
        return;
    }
    blocking_design(&duty, &deck);
    double from_table = deck.area_clean / average->value;
    common_print("\nDeck for %.3g kg/s through holes that pass %.3g kg/(s m2), clearance %.3f, cleaned every %.0f s:\n",
                 duty.passing, duty.capacity, duty.clearance, duty.run_time);
    common_print(
        "  nothing blocked %.4f m2; on average over the run %.4f m2 (f %.4f); at every moment %.4f m2 (f %.4f)\n",
        deck.area_clean, deck.area_mean, deck.free_mean, deck.area_lowest, deck.free_lowest);
    if (deck.area_mean_low95 > 0.0)
        common_print("  95 %% range from the readings: on average %.4f .. %.4f m2, at every moment %.4f .. %.4f m2\n",
                     deck.area_mean_low95, deck.area_mean_high95, deck.area_lowest_low95, deck.area_lowest_high95);
    common_print("  by Table 3, %s: %.4f m2 (f* %.4f)%s\n", blocking_shape_text(shape), from_table, average->value,
                 average->flags & BLOCKING_FLAG_BOX ? ", an extrapolation" : "");
    json_object_begin(report, "deck");
    results_values(report, {"passing_kg_per_s", duty.passing}, {"capacity_kg_per_s_m2", duty.capacity},
                   {"clearance", duty.clearance}, {"run_time_s", duty.run_time}, {"free_mean", deck.free_mean},
                   {"free_lowest", deck.free_lowest}, {"effective_area_m2", deck.effective_area},
                   {"area_clean_m2", deck.area_clean}, {"area_mean_m2", deck.area_mean},
                   {"area_lowest_m2", deck.area_lowest}, {"area_mean_low95_m2", deck.area_mean_low95},
                   {"area_mean_high95_m2", deck.area_mean_high95}, {"area_lowest_low95_m2", deck.area_lowest_low95},
                   {"area_lowest_high95_m2", deck.area_lowest_high95}, {"area_table3_m2", from_table});
    json_object_end(report);

    double longest = fmax(10.0 * duty.run_time, duty.k > 0.0 ? 20.0 / duty.k : 0.0);
    result_table *t = results_of("run_time_s,free_now,free_mean,area_mean_m2,area_lowest_m2");
    for (int i = 0; i < CURVE; i++) {
        blocking_deck d;
        duty.run_time = longest * pow(1e-4, 1.0 - (double)i / (CURVE - 1));
        blocking_design(&duty, &d);
        results_row(t, NULL, duty.run_time, blocking_curve(duty.f0, duty.f_inf, duty.k, duty.run_time), d.free_mean,
                    d.area_mean, d.area_lowest);
    }
    results_csv(t, self->out, "deck.csv");
    const double *T = results_column(t, "run_time_s", 1.0);
    riddle_plot *figure = riddle_plot_new("Deck area after blocking", 1, 2);
    riddle_plot_panel(figure, 0, 0, "time since cleaning [s]", "free holes f [-]");
    riddle_plot_log_x(figure);
    riddle_plot_line(figure, "now", T, results_column(t, "free_now", 1.0), CURVE);
    riddle_plot_line(figure, "mean since cleaning", T, results_column(t, "free_mean", 1.0), CURVE);
    riddle_plot_panel(figure, 0, 1, "time between cleanings [s]", "deck area [m²]");
    riddle_plot_log_x(figure);
    riddle_plot_line(figure, "duty met at every moment", T, results_column(t, "area_lowest_m2", 1.0), CURVE);
    riddle_plot_line(figure, "duty met on average", T, results_column(t, "area_mean_m2", 1.0), CURVE);
    riddle_plot_horizontal(figure, "nothing blocked", deck.area_clean);
    if (!(average->flags & BLOCKING_FLAG_BOX)) riddle_plot_horizontal(figure, "by Table 3", from_table);
    riddle_plot_write(figure, self->out, "deck.svg");
    results_free(t);
}

/* x_h of a size curve in a file. */
static double hard_content(const program *self, const char *path, double opening) {
    sheet_sizes curve;
    char message[600];
    if (sheet_read_sizes(path, NULL, 1, &curve, message, sizeof message) != 0)
        program_refuse(self, "sizes", path, message);
    if (curve.single)
        program_refuse(self, "sizes", path,
                       "a sieve curve: the column passing or retained, not shares of single sizes");
    common_print("%s\n", curve.how);
    blocking_hard hard;
    const blocking_status status =
        blocking_hard_from_curve(curve.size, curve.amount[0], (size_t)curve.n, opening, &hard);
    sheet_free_sizes(&curve);
    if (status != BLOCKING_OK) refuse_file(self, "sizes", path, sizes_file, blocking_status_text(status));
    common_print("Hard-to-screen content of %s for %g mm: x_h %.4f = %.4f below the opening + %.4f above it\n\n", path,
                 1e3 * opening, hard.x_h, hard.below, hard.above);
    return hard.x_h;
}

static int finish(json *report, const program *self) {
    if (common_interrupted()) json_discard(report);
    else {
        json_program(report, self);
        json_close(report);
    }
    return common_exit_status();
}

/* ---- what was asked for ---- */

typedef struct wish {
    const char *data, *sizes, *tests; /* files, or NULL */
    bool simulated, swept, compared;
    int row, holes; /* without these: readings of a row of Table 2 */
    sieve_patch_def patch;
    int seeds, shape;                              /* shape: a blocking_shape */
    double vibrated, K, x_h;                       /* [s], [-], [-] */
    double frequency, amplitude, direction, slope; /* [Hz], [mm], [degrees], [degrees]: they give K unless
                                                      it was given */
    double opening, wire;                          /* [mm] */
    double passing, capacity, run_time;            /* [kg/s], [kg/(s m2)], [s] */
} wish;

static wish default_wish(void) {
    wish w = {0};
    w.row = 1, w.holes = 400, w.seeds = 2;
    w.patch = sieve_patch_default();
    w.vibrated = 8.0, w.K = 1.5, w.x_h = 0.5;
    w.frequency = 70.0 / 3.0, w.amplitude = 0.7, w.direction = 90.0, w.slope = 15.0;
    w.opening = 0.63, w.wire = 0.4;
    w.passing = 0.08, w.capacity = 2.0, w.run_time = 600.0;
    return w;
}

/* Refuses what does not go together. */
static void check_wish(const program *self, const wish *w) {
    const bool process = w->simulated || w->swept || w->compared;
    if (is_given(self, "k") && (is_given(self, "frequency-hz") || is_given(self, "amplitude-mm") ||
                                is_given(self, "direction-deg") || is_given(self, "slope-deg")))
        program_refuse(self, "k", NULL, "either --k or the motion of the deck");
    if (w->sizes && is_given(self, "xh")) program_refuse(self, "xh", NULL, "either --xh or --sizes");
    if (w->tests && (w->data || process))
        program_refuse(self, "tests", w->tests, "without --data and without a simulation");
    if (process && w->data) program_refuse(self, "data", w->data, "either --data or a simulation");
    if (process && !(w->wire > 0.0)) program_refuse(self, "wire-mm", NULL, "above 0 for a simulation");
}

/* Computes what follows from the options. */
static void complete_wish(const program *self, wish *w) {
    const bool several = w->swept || w->compared;
    if (!is_given(self, "k"))
        w->K = blocking_toss_indicator(w->frequency, 1e-3 * w->amplitude, w->direction * RIDDLE_PI / 180.0,
                                       w->slope * RIDDLE_PI / 180.0, 9.81);
    if (w->sizes) w->x_h = hard_content(self, w->sizes, 1e-3 * w->opening);
    if (self->quick && !is_given(self, "patch")) w->patch.across = several ? 6 : 8;
    if (self->quick && !is_given(self, "vibrated-s")) w->vibrated = several ? 0.25 : 1.0;
    if (self->quick && !is_given(self, "load-kg-m2")) w->patch.load = 0.5;
    if (self->quick && !is_given(self, "overlap")) w->patch.overlap = 0.04;
    w->patch.opening = 1e-3 * w->opening, w->patch.wire = 1e-3 * w->wire;
    w->patch.K = w->K, w->patch.frequency = w->frequency, w->patch.x_h = w->x_h;
    w->patch.seed = self->seed; /* one thread: too few contacts for more */
    if (!w->simulated && !several) return;
    const int at_once = w->simulated ? 1 : w->swept ? KS * XS : WAYS * w->seeds;
    program_need_spheres(self, "load-kg-m2",
                         sieve_patch_expected(&w->patch) * (self->threads < at_once ? self->threads : at_once));
}

/* Mean free fraction by Table 3. */
static blocking_average average_of(const wish *w) {
    blocking_conditions conditions = blocking_default_conditions();
    blocking_average average;
    conditions.K = w->K;
    conditions.x_h = w->x_h;
    conditions.opening = 1e-3 * w->opening;
    blocking_average_free((blocking_shape)w->shape, &conditions, &average);
    return average;
}

static blocking_duty duty_of(const wish *w) {
    blocking_duty duty = blocking_default_duty();
    duty.passing = w->passing;
    duty.capacity = w->capacity;
    duty.clearance = blocking_open_area(w->opening, w->wire);
    duty.run_time = w->run_time;
    return duty;
}

/* Gets readings from the file, from a simulation, or from Table 2, and the name of their source. Returns -1 if a
   simulation failed. */
static int get_readings(const program *self, json *report, const wish *w, readings *r, char *source, size_t size) {
    if (w->data) {
        read_readings(self, w->data, r);
        snprintf(source, size, "%.150s", w->data);
    } else if (w->simulated) {
        sieve_patch patch;
        progress bar;
        progress_begin(&bar, "simulating", w->vibrated);
        const int failed = simulate(&w->patch, w->vibrated, r, &patch, &bar);
        progress_end(&bar);
        if (!failed) report_simulation(report, &patch, r);
        dem_free(&patch.world);
        snprintf(source, size, "simulated spheres, K %.3g, x_h %.3g, %g mm", w->K, w->x_h, w->opening);
        return failed;
    } else {
        const row *from = &table2[2 * w->row];
        draw_readings(r, from, w->holes, self->seed);
        snprintf(source, size, "drawn from Lawinska et al. (2016), Table 2, row %s, %d holes", from->figure, w->holes);
    }
    return 0;
}

/* The pages of readings: Table 2, the curve fitted to them, Table 3, and the deck for the duty. */
static void evaluate(const program *self, json *report, const wish *w, readings *r, const char *source) {
    const double K = w->K;
    const blocking_average average = average_of(w);
    blocking_fit_result fit;
    const blocking_status status = fit_readings(r, &fit);
    if (status >= BLOCKING_OUT_OF_RANGE && w->data)
        refuse_file(self, "data", w->data, counts_file, blocking_status_text(status));

    common_print("Toss indicator K %.4f: %s\n\n", K, blocking_toss_text(blocking_toss_range(K)));
    json_number(report, "toss_indicator", K);
    json_string(report, "toss_range", blocking_toss_text(blocking_toss_range(K)));
    draw_table2(self, report);
    report_fit(report, r, status, &fit, source);
    draw_fit(self, report, r, &fit, source, w->data || w->simulated ? NULL : &table2[2 * w->row]);
    draw_polynomials(self, report, K, w->x_h);

    blocking_duty duty = duty_of(w);
    duty.f0 = fit.f0;
    duty.f_inf = fit.f_inf;
    duty.k = status == BLOCKING_NO_CHANGE ? 0.0 : fit.k;
    blocking_fit_def ranges = blocking_default_fit_def();
    ranges.z = z95;
    blocking_fit_range(&ranges, r->t, r->f, r->counted ? r->sigma : NULL, (size_t)r->n, w->run_time, &duty.last_lowest,
                       &duty.last_highest, &duty.mean_lowest, &duty.mean_highest);
    design(self, report, duty, &average, (blocking_shape)w->shape);
}

static void evaluate_tests(const program *self, json *report, const wish *w) {
    const blocking_average average = average_of(w);
    blocking_duty duty = duty_of(w);
    fit_tests(self, report, w->tests, w->K, w->x_h, &duty);
    design(self, report, duty, &average, (blocking_shape)w->shape);
}

int main(int argc, char **argv) {
    wish w = default_wish();
    option options[] = {
        option_string("data", "FILE", &w.data,
                      "counted holes: CSV with time_s,free_holes,holes or time_s,free_fraction"),
        option_choice("row", &w.row, "7a|7b|8a|8b", "without --data: the experiment of Table 2 to draw readings from"),
        option_int("holes", "N", &w.holes, 1, 100000, "without --data: holes counted at each time"),
        option_string("sizes", "FILE", &w.sizes, "size curve of the feed: CSV with size_mm,passing (0..1); gives x_h"),
        option_double("xh", "X", &w.x_h, 0.0, 1.0, "hard-to-screen content of the feed [-], a fraction"),
        option_double("k", "K", &w.K, 0.0, 100.0, "toss indicator [-]; otherwise from the next four"),
        option_positive("frequency-hz", "N", &w.frequency, 1000.0, "frequency of the deck [Hz]"),
        option_positive("amplitude-mm", "A", &w.amplitude, 100.0, "amplitude of the deck, half its stroke [mm]"),
        option_double("direction-deg", "BETA", &w.direction, 0.0, 180.0,
                      "direction of the vibration against the deck [degrees]"),
        option_double("slope-deg", "ALPHA", &w.slope, 0.0, 89.0, "slope of the deck [degrees]"),
        option_choice("shape", &w.shape, "spherical|irregular|sharp|sharp-repaired", "grains, for Table 3"),
        option_positive("opening-mm", "L", &w.opening, 1000.0, "size of the holes [mm]"),
        option_double("wire-mm", "W", &w.wire, 0.0, 1000.0, "diameter of the wires [mm]"),
        option_positive("passing-kg-s", "M", &w.passing, 1e6, "duty: undersize that must pass [kg/s]"),
        option_positive("capacity", "C", &w.capacity, 1e6,
                        "what passes a square metre of free holes [kg/(s m2)]; from a test with your feed"),
        option_double("run-time-s", "T", &w.run_time, 0.0, 1e9, "time between two cleanings of the deck [s]"),
        option_flag("simulate", &w.simulated,
                    "readings from a simulation of spheres on a vibrated patch of this sieve at --k, --xh"),
        option_flag("sweep", &w.swept, "simulations at five K and three x_h beside Table 3"),
        option_flag("continuous", &w.compared,
                    "simulations of Fig 12: intermittent and continuous screening at --k, --xh"),
        option_int("seeds", "N", &w.seeds, 1, WAY_SEEDS, "continuous: layers of each"),
        option_double("vibrated-s", "T", &w.vibrated, 0.2, 2048.0, "simulation: time of vibration [s]"),
        option_int("patch", "N", &w.patch.across, 6, 200, "simulation: holes along each side of the periodic patch"),
        option_double("load-kg-m2", "M", &w.patch.load, 0.1, 100.0, "simulation: grains laid on the sieve [kg/m2]"),
        option_double("friction", "MU", &w.patch.friction, 0.0, 10.0,
                      "simulation: Coulomb coefficient of grains and wires [-]"),
        option_double(
            "overlap", "S", &w.patch.overlap, 1e-4, 0.1,
            "simulation: overlap of a grain that hits a wire, over its size [-]: sets the stiffness and the step"),
        option_string("tests", "FILE", &w.tests,
                      "many tests: k1 and k2 as laws of K, x_h, moisture, their values and the deck at --k, --xh"),
    };
    program self = program_start(
        "sieve_blocking",
        "Blocking of sieve holes: curves, rate constants from counted holes, Table 3 and the deck area for a duty.",
        options, (int)(sizeof options / sizeof *options), argc, argv);
    check_wish(&self, &w);
    complete_wish(&self, &w);
    json *report = json_open(self.json);
    readings r;
    char source[200];
    if (w.tests) evaluate_tests(&self, report, &w);
    else if (w.swept) sweep(&self, report, &w.patch, w.vibrated);
    else if (w.compared) compare_ways(&self, report, &w.patch, w.vibrated, self.quick ? 1 : w.seeds);
    else if (!get_readings(&self, report, &w, &r, source, sizeof source)) evaluate(&self, report, &w, &r, source);
    return finish(report, &self);
}
