/* screening_study.h - a study is a number of variants of a scene, each run with several seeds: its runs in files, and
   its statistics. */
#ifndef SCREENING_STUDY_H
#define SCREENING_STUDY_H

#include <pthread.h>

#include "screening_scene.h"

/* ---- a study: variants, each with several seeds ---- */

enum { VARIANTS_MAX = CASES, NAME = 32 };
static const double CURVE_STEP = 0.5; /* of the table of all curves [s] */

typedef struct variant {
    settings set;
    char name[NAME];
} variant;

typedef enum study_kind { STUDY_ONE, STUDY_CASES, STUDY_VARY, STUDY_MOISTURE, STUDY_SENSITIVITY } study_kind;

typedef struct study {
    study_kind kind;
    variant variants[VARIANTS_MAX]; /* the first is what was asked for */
    int variant_count, seeds, samples;
    uint64_t seed;
    result *results;        /* [variants][seeds] */
    int left[VARIANTS_MAX]; /* runs of a variant that are not done, under lock */
    pthread_mutex_t lock;
    const program *self;
    const char *runs; /* folder of the files of single runs, or NULL */
    progress *bar;
    dem_io_series *series;
    world_movie *reel;
} study;

static result *result_of(const study *st, int v, int q) { return &st->results[v * st->seeds + q]; }

static variant *add_variant(study *st, const settings *set, const char *name) {
    variant *v = &st->variants[st->variant_count++];
    v->set = *set;
    snprintf(v->name, sizeof v->name, "%s", name);
    return v;
}

static int make_results(study *st) {
    const size_t runs = (size_t)(st->variant_count * st->seeds), samples = (size_t)st->samples;
    st->results = calloc(runs, sizeof *st->results);
    for (size_t k = 0; st->results && k < runs; k++) {
        double *block = calloc(samples, CURVES * sizeof *block);
        if (!block) return -1;
        for (size_t c = 0; c < CURVES; c++) st->results[k].curve[c] = block + c * samples;
    }
    return st->results ? 0 : -1;
}

/* ---- a run in files: its curves, and then one row of settings and numbers, which tells that it is whole ---- */

static const char *run_file(char *buffer, size_t size, const study *st, int v, int q, const char *end) {
    snprintf(buffer, size, "%s_seed_%d%s.csv", st->variants[v].name, q + 1, end);
    for (char *c = buffer; *c; c++)
        if (*c == ' ') *c = '_';
    return buffer;
}

/* Appends ",a,b,c". */
static void name_columns(char *header, size_t size, const char *const *names, int n) {
    for (int k = 0; k < n; k++) snprintf(header + strlen(header), size - strlen(header), ",%s", names[k]);
}

static void write_run(const study *st, int v, int q) {
    const result *r = result_of(st, v, q);
    char name[100], header[1000] = "time_s", run_header[1000] = "mixture";
    double row[1 + SETTINGS + NUMBERS];
    name_columns(header, sizeof header, curve_name, CURVES);
    name_columns(run_header, sizeof run_header, setting_name, SETTINGS);
    name_columns(run_header, sizeof run_header, number_name, NUMBERS);
    riddle_io_file *file = csv_open(st->runs, run_file(name, sizeof name, st, v, q, ""), header);
    for (int k = 0; k < r->samples; k++) {
        row[0] = k * SAMPLE;
        for (int c = 0; c < CURVES; c++) row[1 + c] = r->curve[c][k];
        riddle_io_row(file, row, 1 + CURVES);
    }
    if (riddle_io_close(file)) return;
    row[0] = (double)(st->seed + (uint64_t)q);
    list_settings(&st->variants[v].set, row + 1);
    memcpy(row + 1 + SETTINGS, r->number, sizeof r->number);
    file = csv_open(st->runs, run_file(name, sizeof name, st, v, q, "_run"), run_header);
    riddle_io_row(file, row, 1 + SETTINGS + NUMBERS);
    riddle_io_close(file);
}

/* Whether the run was written before, with the same settings; then it is as if it had been done. */
static bool read_run(const study *st, int v, int q) {
    result *r = result_of(st, v, q);
    char name[100], path[4096], message[300];
    double wanted[1 + SETTINGS];
    csv_data data;
    wanted[0] = (double)(st->seed + (uint64_t)q);
    list_settings(&st->variants[v].set, wanted + 1);
    if (csv_read(riddle_io_path(path, sizeof path, st->runs, run_file(name, sizeof name, st, v, q, "_run")), &data,
                 message, sizeof message))
        return false;
    bool same = data.rows == 1 && data.columns == 1 + SETTINGS + NUMBERS;
    for (int k = 0; k < 1 + SETTINGS && same; k++) same = data.values[k] == wanted[k];
    for (int k = 0; k < NUMBERS && same; k++) {
        const int column = csv_column(&data, number_name[k]);
        same = column >= 0;
        if (same) r->number[k] = data.values[column];
    }
    csv_free(&data);
    if (!same || csv_read(riddle_io_path(path, sizeof path, st->runs, run_file(name, sizeof name, st, v, q, "")), &data,
                          message, sizeof message))
        return false;
    if (data.rows == st->samples && data.columns == 1 + CURVES) {
        for (int k = 0; k < data.rows; k++)
            for (int c = 0; c < CURVES; c++) r->curve[c][k] = data.values[k * data.columns + 1 + c];
        r->samples = data.rows;
        r->done = true;
    }
    csv_free(&data);
    return r->done;
}

/* ---- statistics ---- */

/* Mean and standard deviation of n values; two-sided 95 % interval of the mean. One run says nothing of the scatter:
   both are NaN then. */
typedef struct statistics {
    double mean, sd, interval;
} statistics;

/* Two-sided 95 % quantile of Student's t; the tabulated values of any textbook. */
static double student(int freedom) {
    static const double t[] = {0,     12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
                               2.201, 2.179,  2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086, 2.080,
                               2.074, 2.069,  2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042};
    return freedom < 1 ? 0.0 : freedom <= 30 ? t[freedom] : 1.96 + 2.4 / freedom;
}

static statistics statistics_of(int n, const double *values) {
    statistics s = {0.0, (double)NAN, (double)NAN};
    for (int q = 0; q < n; q++) s.mean += values[q] / n;
    if (n < 2) return s;
    s.sd = 0.0;
    for (int q = 0; q < n; q++) s.sd += (values[q] - s.mean) * (values[q] - s.mean);
    s.sd = sqrt(s.sd / (n - 1));
    s.interval = student(n - 1) * s.sd / sqrt((double)n);
    return s;
}

enum { INTERVAL_TEXT = 24 };

/* " +- 0.012", or nothing where it is not known. */
static const char *within(char text[INTERVAL_TEXT], double interval) {
    if (isnan(interval)) text[0] = '\0';
    else snprintf(text, INTERVAL_TEXT, " +- %.3f", interval);
    return text;
}

/* A cell of a number that may not be known. */
static void interval_cell(riddle_io_table *t, int digits, double value) {
    if (isnan(value)) riddle_io_table_cell(t, "-");
    else riddle_io_table_cell(t, "%.*f", digits, value);
}

enum { SEEDS_MAX = 1000 };

/* One number of a run: the mean of a curve from one time to another [s]; or, with a class's top layer, the
   mean time in it. */
typedef struct measure {
    int curve; /* or TOP_LAYER + class */
    double from, to;
} measure;
enum { TOP_LAYER = CURVES };

static measure over_time(int curve, double from, double to) {
    const measure m = {curve, from, to};
    return m;
}
static measure at_time(int curve, double time) { return over_time(curve, time, time); }
static measure top_layer(int c) { return over_time(TOP_LAYER + c, 0.0, 0.0); }

static double measured(const study *st, int v, int q, measure m) {
    const result *r = result_of(st, v, q);
    if (m.curve >= TOP_LAYER) return r->number[TOP_SMALL + m.curve - TOP_LAYER];
    const int last = st->samples - 1;
    const int first = (int)fmin(m.from / SAMPLE + 0.5, last), end = (int)fmin(m.to / SAMPLE + 0.5, last);
    double sum = 0.0;
    for (int k = first; k <= end; k++) sum += r->curve[m.curve][k];
    return sum / (end - first + 1);
}

static statistics measure_of(const study *st, int v, measure m) {
    double values[SEEDS_MAX] = {0.0};
    for (int q = 0; q < st->seeds; q++) values[q] = measured(st, v, q, m);
    return statistics_of(st->seeds, values);
}

/* Difference between two variants. Seeds are pairs of the same mixture: the paired interval is that of the differences,
   the other that of two independent samples (Welch 1947; degrees of freedom of Satterthwaite 1946). NaN
   with one seed. */
typedef struct contrast {
    double difference, paired, independent, correlation;
} contrast;

static contrast contrast_of(const study *st, int from, int to, measure m) {
    double differences[SEEDS_MAX] = {0.0};
    const int n = st->seeds;
    for (int q = 0; q < n; q++) differences[q] = measured(st, to, q, m) - measured(st, from, q, m);
    const statistics d = statistics_of(n, differences), a = measure_of(st, from, m), b = measure_of(st, to, m);
    const double va = a.sd * a.sd / n, vb = b.sd * b.sd / n, sum = va * va + vb * vb;
    const double none = n > 1 ? 0.0 : (double)NAN;
    contrast c = {d.mean, d.interval, none, none};
    if (n > 1 && sum > 0.0) c.independent = student((int)((va + vb) * (va + vb) * (n - 1) / sum)) * sqrt(va + vb);
    if (a.sd > 0.0 && b.sd > 0.0) c.correlation = (a.sd * a.sd + b.sd * b.sd - d.sd * d.sd) / (2.0 * a.sd * b.sd);
    return c;
}

#endif
