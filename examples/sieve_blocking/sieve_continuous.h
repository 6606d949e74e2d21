/* sieve_continuous.h - Fig 12 of Lawinska, Modrzewski & Wodzinski (2016) by sieve_patch.h: does a sieve block in
   continuous screening as it does in intermittent tests? The same mixture on the same sieve, at the same toss
   indicator, on three sieves:
     intermittent   the test of section 2.1: level, vertical vibration, a batch that becomes smaller
     inclined       the same batch at 15 degrees on a circular motion (the industrial screen of section 2.2)
     continuous     the same under a feed: each grain that passes is replaced, so load and mixture are constant */
#ifndef SIEVE_CONTINUOUS_H
#define SIEVE_CONTINUOUS_H

#include "blocking.h"
#include "common.h"
#include "sieve_patch.h"

enum { WAYS = 3, COUNTS = 12, WAY_SEEDS = 20 };
static const char *const way_name[WAYS] = {"intermittent", "inclined", "continuous"};
static const char *const way_label[WAYS] = {"a batch, level (intermittent test)", "a batch, inclined by 15°",
                                            "fed steadily, inclined by 15°"};

typedef struct way_jobs {
    sieve_patch_def def;
    double time;
    int seeds, counts;
    double at[COUNTS], free[WAYS][WAY_SEEDS][COUNTS]; /* [s]; share of the holes */
    ptrdiff_t passed[WAYS][WAY_SEEDS];
    progress bar;
} way_jobs;

static int run_way(int index, void *user) {
    way_jobs *jobs = user;
    const int way = index % WAYS, seed = index / WAYS;
    sieve_patch_def def = jobs->def;
    sieve_patch patch;
    def.seed += (uint64_t)seed;
    if (way > 0) def.slope = RIDDLE_PI / 12.0, def.circular = 1;
    def.refill = way == 2;
    dem_status status = sieve_patch_make(&patch, &def);
    if (status == DEM_OK) status = sieve_patch_lay(&patch);
    int period = 0;
    for (int c = 0; c < jobs->counts && status == DEM_OK && !common_interrupted(); c++) {
        const int wanted = (int)(jobs->at[c] * def.frequency + 0.5);
        if (wanted > period) status = sieve_patch_vibrate(&patch, wanted - period);
        if (status != DEM_OK) break;
        progress_add(&jobs->bar, (wanted - period) / def.frequency);
        period = wanted;
        const int blocked = sieve_patch_blocked(&patch);
        if (blocked < 0) status = DEM_OUT_OF_MEMORY;
        jobs->free[way][seed][c] = 1.0 - (double)blocked / (def.across * def.across);
    }
    jobs->passed[way][seed] = (ptrdiff_t)patch.world.passed_total;
    dem_free(&patch.world);
    if (status != DEM_OK) common_fail("%s, seed %d: %s", way_name[way], seed + 1, dem_status_text(status));
    return status != DEM_OK || common_interrupted();
}

/* Mean over seeds, and 95 % from counting alone. */
static double way_mean(const way_jobs *jobs, int way, int count, double *error) {
    double sum = 0.0;
    for (int s = 0; s < jobs->seeds; s++) sum += jobs->free[way][s][count] / jobs->seeds;
    const double holes = (double)jobs->seeds * jobs->def.across * jobs->def.across,
                 some = fmax(fmin(sum, 1.0 - 1.0 / holes), 1.0 / holes);
    *error = 1.96 * sqrt(some * (1.0 - some) / holes);
    return sum;
}

static void report_ways(const program *self, json *report, const way_jobs *jobs) {
    char title[120], header[200] = "time [s]";
    snprintf(title, sizeof title, "%.3g mm holes, toss indicator K = %.3g, %.3g %% hard to screen",
             1e3 * jobs->def.opening, jobs->def.K, 1e2 * jobs->def.x_h);
    riddle_plot *figure = riddle_plot_new("Holes of a sieve that are free, in batches and under a feed", 1, 1);
    riddle_plot_panel_size(figure, 620, 380);
    riddle_plot_panel(figure, 0, 0, "time [s]", "free holes f [-]");
    riddle_plot_title(figure, title);
    for (int w = 0; w < WAYS; w++) strcat(strcat(header, "|"), way_name[w]);
    common_print("Free holes; +-: 95 %% range by counting holes, as if each were blocked by itself\n");
    riddle_io_table t = riddle_io_table_begin(header);
    riddle_io_file *file =
        csv_open(self->out, "continuous.csv",
                 "time_s,intermittent,inclined,continuous,error_95_intermittent,error_95_inclined,error_95_continuous");
    double mean[WAYS][COUNTS], error[WAYS][COUNTS];
    for (int c = 0; c < jobs->counts; c++) {
        double row[1 + 2 * WAYS] = {jobs->at[c]};
        riddle_io_table_cell(&t, "%.3g", jobs->at[c]);
        for (int w = 0; w < WAYS; w++) {
            row[1 + w] = mean[w][c] = way_mean(jobs, w, c, &error[w][c]);
            row[1 + WAYS + w] = error[w][c];
            riddle_io_table_cell(&t, "%.3f +- %.3f", mean[w][c], error[w][c]);
        }
        riddle_io_row(file, row, 1 + 2 * WAYS);
    }
    table_end(&t);
    riddle_io_close(file);
    json_object_begin(report, "continuous");
    json_array(report, "time_s", jobs->at, jobs->counts);
    for (int w = 0; w < WAYS; w++) {
        double passed = 0.0;
        for (int s = 0; s < jobs->seeds; s++) passed += (double)jobs->passed[w][s] / jobs->seeds;
        common_print("%s: %.0f grains of a sieve passed\n", way_name[w], passed);
        riddle_plot_error_bars(figure, way_label[w], jobs->at, mean[w], error[w], jobs->counts);
        riddle_plot_line(figure, NULL, jobs->at, mean[w], jobs->counts), riddle_plot_style(figure, 0, w);
        json_object_begin(report, way_name[w]);
        json_array(report, "free_fraction", mean[w], jobs->counts);
        json_array(report, "error_95", error[w], jobs->counts);
        json_number(report, "passed", passed);
        json_object_end(report);
    }
    json_object_end(report);
    riddle_plot_write(figure, self->out, "continuous.svg");
}

/* The industrial test's times up to `time`: 0, 5, 10, 30 s, and some in between. */
static void compare_ways(const program *self, json *report, const sieve_patch_def *def, double time, int seeds) {
    static const double when[COUNTS] = {0.0, 0.25, 0.5, 1.0, 2.0, 3.0, 5.0, 7.5, 10.0, 15.0, 20.0, 30.0};
    static way_jobs jobs;
    memset(&jobs, 0, sizeof jobs);
    jobs.def = *def, jobs.time = time, jobs.seeds = seeds;
    while (jobs.counts < COUNTS && when[jobs.counts] <= time * (1.0 + 1e-9))
        jobs.at[jobs.counts] = when[jobs.counts], jobs.counts++;
    progress_begin(&jobs.bar, "sieves", WAYS * seeds * jobs.at[jobs.counts - 1]);
    const int failed = jobs_run(WAYS * seeds, self->threads, run_way, &jobs);
    progress_end(&jobs.bar);
    if (!failed) report_ways(self, report, &jobs);
}

#endif
