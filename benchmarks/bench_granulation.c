/* granulation.h: run time against error.

   1. Population balances: error of M2, M3 and of the number density against the analytic solutions, fixed pivot and
      cell average, three kernels, 20 to 320 cells; constant-number Monte Carlo beside them.
   2. Ensembles of the discrete simulation: standard error of the mean size and of the Type II share against the number
      of replicates.
   3. Contacts: the paper's test at the end of a step against swept contacts in the order of time: collisions missed, by
      length of step.
   4. Cost of a step against the number of granules, 200 to 1 000 000, both ways, at the paper's density.
   Times are processor times of one core. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "granulation.h"

/* ---- 1: population balances ---- */

typedef struct balance_case {
    const char *name;
    granulation_kernel kernel;
    double time, top, m2, m3, n10; /* n10: number density at v = 10, not positive: not compared */
} balance_case;

/* start exp(-v); the product kernel at half of its gel time */
static const balance_case cases[3] = {
    {"constant, t = 10", granulation_constant_kernel, 10.0, 2e3, 12.0, 216.0, 0.00524654452326561},
    {"sum, t = 1", granulation_sum_kernel, 1.0, 5e3, 14.7781121978613, 534.664578858605, 0.00296832859229259},
    {"product, t = 0.25", granulation_product_kernel, 0.25, 5e3, 4.0, 48.0, 0.0},
};

static double exponential_cell(double low, double high, double *mean) {
    double w = high - low, part = -expm1(-w);
    *mean = w < 1e-3 || !(exp(-low) * part > 0.0) ? 0.5 * (low + high) : low + 1.0 - w * exp(-w) / part;
    return exp(-low) * part;
}

/* errors[0..2]: M2, M3, n(10); returns processor seconds of the run */
static double run_balance(const balance_case *c, granulation_scheme scheme, int cells, double errors[3]) {
    double edges[641], pivots[640], numbers[640];
    edges[0] = 0.0;
    for (int i = 1; i <= cells; i++) edges[i] = 1e-3 * pow(c->top / 1e-3, (double)(i - 1) / (cells - 1));
    for (int i = 0; i < cells; i++) numbers[i] = exponential_cell(edges[i], edges[i + 1], pivots + i);
    granulation_balance_def def = granulation_balance_default_def();
    def.scheme = scheme;
    def.kernel = c->kernel;
    granulation_balance b;
    granulation_status status = granulation_balance_init(&b, &def, cells, edges, pivots, 0, NULL, NULL);
    for (int i = 0; i < cells && status == GRANULATION_OK; i++) {
        granulation_granule g = {pivots[i], 0.0, 0.0};
        status = granulation_balance_add(&b, &g, numbers[i]);
    }
    double began = machine_processor_seconds();
    if (status == GRANULATION_OK) status = granulation_balance_run(&b, c->time);
    double seconds = machine_processor_seconds() - began;
    if (status != GRANULATION_OK) common_fail("%s, %d cells: %s", c->name, cells, granulation_status_text(status));
    errors[0] = fabs(granulation_balance_moment(&b, 2.0, 0.0) / c->m2 - 1.0);
    errors[1] = fabs(granulation_balance_moment(&b, 3.0, 0.0) / c->m3 - 1.0);
    int i = 0;
    while (b.pivot[0][i + 1] < 10.0) i++;
    double f = (10.0 - pivots[i]) / (pivots[i + 1] - pivots[i]), n0 = b.number[i] / (edges[i + 1] - edges[i]);
    double n1 = b.number[i + 1] / (edges[i + 2] - edges[i + 1]);
    errors[2] = c->n10 > 0.0 ? fabs(exp((1.0 - f) * log(n0) + f * log(n1)) / c->n10 - 1.0) : (double)NAN;
    granulation_balance_free(&b);
    return seconds;
}

/* root mean square over the runs of the error of M2; seconds of one run */
static double run_montecarlo(const balance_case *c, int n, int runs, uint64_t seed, double *error) {
    granulation_granule *sample = (granulation_granule *)malloc((size_t)n * sizeof *sample);
    double squares = 0.0, seconds = 0.0;
    for (int run = 0; run < runs && sample; run++) {
        granulation_random r = granulation_random_seed(seed + (uint64_t)run);
        for (int i = 0; i < n; i++) {
            sample[i].s = -log(1.0 - granulation_random_uniform(&r));
            sample[i].l = sample[i].a = 0.0;
        }
        granulation_montecarlo mc;
        double began = machine_processor_seconds();
        granulation_status status =
            granulation_montecarlo_init(&mc, sample, n, n, c->kernel, NULL, seed + (uint64_t)run, NULL);
        if (status == GRANULATION_OK) status = granulation_montecarlo_run(&mc, c->time);
        seconds += machine_processor_seconds() - began;
        if (status != GRANULATION_OK) common_fail("Monte Carlo: %s", granulation_status_text(status));
        double e = granulation_montecarlo_moment(&mc, 2.0) / c->m2 - 1.0;
        squares += e * e;
        granulation_montecarlo_free(&mc);
    }
    free(sample);
    *error = sqrt(squares / runs);
    return seconds / runs;
}

static void bench_balances(const program *self, json *report) {
    const int most = self->quick ? 160 : 320;
    riddle_plot *figure = riddle_plot_new("Population balance: error of the second moment against run time", 1, 3);
    static const result_column columns[] = {{"kernel", "kernel", "%s"},          {"scheme", "scheme", "%s"},
                                            {"cells", "cells", "%.0f"},          {"seconds", "time [ms]", "%.2f", 1e3},
                                            {"error_m2", "error of M2", "%.2e"}, {"error_m3", "M3", "%.2e"},
                                            {"error_n10", "n(10)", "%.2e"},      {NULL, "order of M2", "%.2f"}};
    result_table *t = RESULTS(columns),
                 *all = results_of("kernel,scheme,cells_or_sample,seconds,error_m2,error_m3,error_n10");
    for (int k = 0; k < 3; k++) {
        riddle_plot_panel(figure, 0, k, "processor time [s]", k ? "" : "relative error of M2 [-]");
        riddle_plot_title(figure, cases[k].name);
        riddle_plot_log_x(figure);
        riddle_plot_log_y(figure);
        for (int scheme = 0; scheme < 2; scheme++) {
            double x[8], y[8], before = 0.0;
            int points = 0;
            for (int cells = 20; cells <= most; cells *= 2) {
                double e[3], seconds = run_balance(cases + k, (granulation_scheme)scheme, cells, e);
                x[points] = seconds > 1e-6 ? seconds : 1e-6;
                y[points++] = e[0];
                results_row(t, TEXTS(cases[k].name, scheme ? "fixed pivot" : "cell average"), cells, seconds, e[0],
                            e[1], e[2], before > 0.0 ? log2(before / e[0]) : (double)NAN);
                results_row(all, NULL, k, scheme, cells, seconds, e[0], e[1], e[2]);
                before = e[0];
            }
            riddle_plot_line(figure, k == 2 ? (scheme ? "fixed pivot" : "cell average") : NULL, x, y, points);
            riddle_plot_style(figure, RIDDLE_PLOT_MARKED, scheme);
        }
        double x[8], y[8];
        int points = 0;
        for (int n = 100; n <= (self->quick ? 10000 : 100000); n *= 10) {
            x[points] = run_montecarlo(cases + k, n, n > 10000 ? 4 : self->quick ? 8 : 20, self->seed, y + points);
            results_row(all, NULL, k, 2, n, x[points], y[points], NAN, NAN);
            points++;
        }
        riddle_plot_line(figure, k == 2 ? "Monte Carlo" : NULL, x, y, points);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED | RIDDLE_PLOT_DASHED, 2);
        if (k == 2) riddle_plot_legend_outside(figure);
    }
    results_print(t);
    results_json(t, report, "balance");
    results_csv(all, self->out, "balance.csv");
    results_free(t);
    results_free(all);
    riddle_plot_write(figure, self->out, "balance.svg");
}

/* ---- the discrete simulation ---- */

static granulation_status fill(granulation_sim *sim, granulation_def def, int n, uint64_t seed) {
    granulation_granule *g = (granulation_granule *)malloc((size_t)n * sizeof *g);
    def.box = 2e-3 * cbrt(n / 192.0);
    def.seed = seed;
    granulation_status status = granulation_sim_init(sim, &def);
    if (!g) return GRANULATION_NO_MEMORY;
    for (int i = 0; i < n; i++) {
        int k = i % 192;
        double v = k < 120 ? 2e-12 : k < 162 ? 4e-12 : k < 182 ? 6e-12 : k < 187 ? 8e-12 : 10e-12;
        g[i].s = 0.52 * v;
        g[i].l = 0.33 * v;
        g[i].a = 0.15 * v;
    }
    if (status == GRANULATION_OK) status = granulation_sim_add_many(sim, g, n);
    free(g);
    return status;
}

/* 2: how many replicates for which error */
static void bench_ensembles(const program *self, json *report) {
    const int most = self->quick ? 64 : 512;
    double *size = (double *)malloc((size_t)most * sizeof *size),
           *share = (double *)malloc((size_t)most * sizeof *share);
    double began = machine_processor_seconds();
    for (int i = 0; size && share && i < most && !common_interrupted(); i++) {
        granulation_sim sim;
        granulation_status status = fill(&sim, granulation_paper_def(), 192, self->seed + (uint64_t)i);
        if (status == GRANULATION_OK) status = granulation_sim_run(&sim, 100);
        if (status != GRANULATION_OK) common_fail("replicate: %s", granulation_status_text(status));
        granulation_replicate r = granulation_replicate_of(&sim);
        granulation_sim_free(&sim);
        size[i] = r.mean_size;
        share[i] = r.type2;
    }
    double one = (machine_processor_seconds() - began) / most;
    result_table *t = results_of("replicates,seconds,d43_relative_standard_error,type2_standard_error_points");
    json_object_begin(report, "ensemble");
    json_number(report, "seconds_per_replicate", one);
    for (int n = 4; n <= most; n *= 2) { /* the scatter of means of n, from all groups of n */
        double means[2][128], y[2];
        int groups = most / n > 128 ? 128 : most / n;
        if (groups < 8) { /* too few groups to scatter: the deviation over root n */
            y[0] = granulation_estimate_of(size, n, 1).deviation / sqrt(n) / granulation_estimate_of(size, n, 1).mean;
            y[1] = granulation_estimate_of(share, n, 1).deviation / sqrt(n);
        } else {
            for (int g = 0; g < groups; g++) {
                means[0][g] = granulation_estimate_of(size + (size_t)g * (size_t)n, n, 1).mean;
                means[1][g] = granulation_estimate_of(share + (size_t)g * (size_t)n, n, 1).mean;
            }
            y[0] = granulation_estimate_of(means[0], groups, 1).deviation /
                   granulation_estimate_of(means[0], groups, 1).mean;
            y[1] = granulation_estimate_of(means[1], groups, 1).deviation;
        }
        results_row(t, NULL, n, n * one, y[0], y[1]);
    }
    results_csv(t, self->out, "ensembles.csv");
    const int points = results_rows(t);
    const double *x = results_column(t, "seconds", 1.0), *d43 = results_column(t, "d43_relative_standard_error", 1.0),
                 *type2 = results_column(t, "type2_standard_error_points", 1.0);
    json_array(report, "seconds", x, points);
    json_array(report, "d43_relative_standard_error", d43, points);
    json_array(report, "type2_standard_error_points", type2, points);
    json_object_end(report);
    riddle_plot *figure = riddle_plot_new("Ensembles of the paper's simulation (192 granules, 100 steps)", 1, 2);
    for (int p = 0; p < 2; p++) {
        riddle_plot_panel(figure, 0, p, "processor time [s]",
                          p ? "standard error of Type II [points]" : "relative standard error of d43 [-]");
        riddle_plot_log_x(figure);
        riddle_plot_log_y(figure);
        const double *y = p ? type2 : d43;
        riddle_plot_line(figure, "4 to 512 replicates", x, y, points);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
        double guide[2] = {y[0], y[0] * sqrt(x[0] / x[points - 1])}, ends[2] = {x[0], x[points - 1]};
        riddle_plot_line(figure, "one over root n", ends, guide, 2);
        riddle_plot_style(figure, RIDDLE_PLOT_DASHED | RIDDLE_PLOT_THIN, RIDDLE_PLOT_GREY);
    }
    riddle_plot_write(figure, self->out, "ensembles.svg");
    results_free(t);
    free(size);
    free(share);
}

/* 3: collisions of elastic granules on the same path, in ever shorter steps, against all of them */
static void bench_contacts(const program *self, json *report) {
    const int n = self->quick ? 1000 : 4000;
    double x[12], y[12], exact = 0.0, exact_seconds = 0.0;
    int points = 0;
    static const result_column columns[] = {
        {"contacts|", "contacts", "%s"},
        {"path_in_diameters|path_of_a_step_in_mean_diameters", "path of a step [diameters]", "%.3f"},
        {"seconds", "time [ms]", "%.1f", 1e3},
        {"collisions", "collisions", "%.0f"},
        {NULL, "missed [%]", "%.2f", 100.0},
        {"|exact"},
        {"|swept_seconds"}};
    result_table *t = RESULTS(columns);
    for (int k = -1; k < (self->quick ? 7 : 9) && !common_interrupted(); k++) {
        granulation_def def = granulation_default_def();
        def.consolidation = 0.0; /* dry granules: they only bounce */
        def.breakage = false;
        if (k >= 0) {
            def.detection = GRANULATION_END_OF_STEP;
            def.dilation *= 1 << k;
        }
        granulation_sim sim;
        granulation_status status = fill(&sim, def, n, self->seed);
        int steps = k < 0 ? 10 : 10 << k;
        double began = machine_processor_seconds();
        if (status == GRANULATION_OK) status = granulation_sim_run(&sim, steps);
        double seconds = machine_processor_seconds() - began, met = (double)sim.tally.interactions;
        if (status != GRANULATION_OK) common_fail("contacts: %s", granulation_status_text(status));
        /* relative to the mean velocity a granule has sqrt(3) m/s */
        double path = sqrt(3.0) / def.dilation / granulation_sim_mean(&sim, 1, 0);
        granulation_sim_free(&sim);
        if (k < 0) {
            exact = met;
            exact_seconds = seconds;
        } else {
            x[points] = seconds;
            y[points++] = fabs(met / exact - 1.0);
        }
        results_row(t, TEXTS(k < 0 ? "swept" : "end of step"), path, seconds, met, 1.0 - met / exact, exact,
                    exact_seconds);
    }
    results_write(t, report, "contacts", self->out, "contacts.csv");
    results_free(t);
    riddle_plot *figure = riddle_plot_new("Contacts: time-stepped against event-driven", 1, 1);
    riddle_plot_panel(figure, 0, 0, "processor time [s]", "share of the collisions missed or too many [-]");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    riddle_plot_line(figure, "end of step, steps 1 to 1/256", x, y, points);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_vertical(figure, "swept: none missed", exact_seconds);
    riddle_plot_horizontal(figure, "scatter of a run", 1.0 / sqrt(exact > 1.0 ? exact : 1.0));
    riddle_plot_write(figure, self->out, "contacts.svg");
}

/* 4: cost against the number of granules; the fastest of some steps */
static void bench_cost(const program *self, json *report) {
    const int numbers[5] = {200, 2000, 20000, 200000, 1000000};
    double x[5], y[2][5];
    int points = self->quick ? 3 : 5;
    static const result_column columns[] = {
        {"granules", "granules", "%.0f"}, {"end_of_step_s", "end of step [s a step]", "%.3g"},
        {NULL, "ns a granule", "%.0f"},   {"swept_s", "swept [s a step]", "%.3g"},
        {NULL, "ns a granule", "%.0f"},   {"|swept_collisions", "collisions swept", "%.0f"}};
    result_table *t = RESULTS(columns);
    for (int k = 0; k < points && !common_interrupted(); k++) {
        int n = numbers[k], repeats = n < 1000 ? 200 : n < 100000 ? 20 : 6;
        double best[2] = {HUGE_VAL, HUGE_VAL}, collisions = 0.0;
        for (int mode = 0; mode < 2; mode++) {
            granulation_def def = mode ? granulation_default_def() : granulation_paper_def();
            /* a third of a diameter: about as many collisions as the paper's rule finds */
            if (mode) def.dilation = 1e5;
            granulation_sim sim;
            granulation_status status = fill(&sim, def, n, self->seed);
            for (int i = 0; i < repeats && status == GRANULATION_OK; i++) {
                int64_t met = sim.tally.interactions;
                double began = machine_processor_seconds();
                status = granulation_sim_run(&sim, 1);
                double seconds = machine_processor_seconds() - began;
                if (seconds < best[mode]) {
                    best[mode] = seconds;
                    if (mode) collisions = (double)(sim.tally.interactions - met);
                }
            }
            if (status != GRANULATION_OK) common_fail("%d granules: %s", n, granulation_status_text(status));
            granulation_sim_free(&sim);
        }
        x[k] = n;
        for (int mode = 0; mode < 2; mode++) y[mode][k] = 1e9 * best[mode] / n;
        results_row(t, NULL, n, best[0], y[0][k], best[1], y[1][k], collisions);
    }
    results_write(t, report, "cost", self->out, "cost.csv");
    results_free(t);
    riddle_plot *figure = riddle_plot_new("Cost of a step at the paper's density, one core", 1, 1);
    riddle_plot_panel(figure, 0, 0, "granules [-]", "processor time a granule and step [ns]");
    riddle_plot_log_x(figure);
    riddle_plot_range_y(figure, 0.0, 1.2 * fmax(fmax(y[0][points - 1], y[1][points - 1]), fmax(y[0][0], y[1][0])));
    riddle_plot_line(figure, "paper's rule, steps of 3 diameters", x, y[0], points);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_line(figure, "swept, steps of a third of a diameter", x, y[1], points);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_write(figure, self->out, "cost.svg");
}

/* 5: the two studies of the paper, 4 + 4 rows of 50 replicates */
static void bench_studies(const program *self, json *report) {
    const double speeds[8] = {1, 3, 6, 7, 3, 3, 3, 3}, liquid[8] = {.33, .33, .33, .33, .15, .25, .33, .40};
    const int replicates = self->quick ? 5 : 50;
    double began = machine_processor_seconds();
    for (int c = 0; c < 8; c++)
        for (int run = 0; run < replicates; run++) {
            granulation_def def = granulation_paper_def();
            granulation_sim sim;
            def.seed = self->seed + (uint64_t)run;
            for (int k = 0; k < 3; k++) def.velocity_mean[k] = speeds[c];
            granulation_status status = granulation_sim_init(&sim, &def);
            const int count[5] = {120, 42, 20, 5, 5};
            for (int k = 0; k < 5 && status == GRANULATION_OK; k++) {
                double v = 2e-12 * (k + 1);
                granulation_granule g = {v * (0.85 - liquid[c]), v * liquid[c], v * 0.15};
                status = granulation_sim_add(&sim, &g, count[k]);
            }
            if (status == GRANULATION_OK) status = granulation_sim_run(&sim, 100);
            if (status != GRANULATION_OK) common_fail("study: %s", granulation_status_text(status));
            granulation_sim_free(&sim);
        }
    double seconds = machine_processor_seconds() - began;
    common_print("Tables 2 and 3, 8 conditions x %d replicates: %.2f s on one core\n", replicates, seconds);
    json_number(report, "studies_s", seconds);
    json_integer(report, "studies_replicates", replicates);
}

int main(int argc, char **argv) {
    program self = program_start("bench_granulation",
                                 "Run time against error for granulation.h. Writes SVG figures and CSV tables.", NULL,
                                 0, argc, argv);
    json *report = json_open(self.json);
    bench_studies(&self, report);
    if (!common_interrupted()) bench_balances(&self, report);
    if (!common_interrupted()) bench_ensembles(&self, report);
    if (!common_interrupted()) bench_contacts(&self, report);
    if (!common_interrupted()) bench_cost(&self, report);
    json_program(report, &self);
    if (common_interrupted()) json_discard(report);
    else json_close(report);
    return common_exit_status();
}
