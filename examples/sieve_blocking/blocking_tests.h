/* blocking_tests.h - counted holes of many blocking tests from a CSV file, and the law of k1 and k2 that blocking.h
   fits to them.

   One row a reading, rows of a test together and by time: test (a name or number), time_s, K, free_holes and holes (or
   free_fraction); x_h and moisture where they were not the same in all tests. */
#ifndef BLOCKING_TESTS_H
#define BLOCKING_TESTS_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "blocking.h"
#include "common.h"

enum { BLOCKING_TESTS = 200, BLOCKING_TEST_ROWS = 20000 };
static const char *const blocking_tests_file = "a file with the columns test,time_s,K,x_h,moisture and "
                                               "free_holes,holes or free_fraction; x_h and moisture may be missing";

/* Leaves: the file of an option is no good for this reason. */
static inline void refuse_file(const program *self, const char *option_name, const char *path, const char *what,
                               const char *reason) {
    char text[800];
    snprintf(text, sizeof text, "%s; this one: %s", what, reason);
    program_refuse(self, option_name, path, text);
}

/* The standard error of a count; two holes are added so that a sieve counted all free is not taken for certain (Agresti
   & Coull 1998). */
static inline double counting_error(double free_holes, double holes) {
    double f = (free_holes + 1.0) / (holes + 2.0);
    return sqrt(f * (1.0 - f) / holes);
}

/* A curve through counts of holes, whole numbers, n at most BLOCKING_TEST_ROWS; f and sigma: the readings and their
   standard errors. These are those of the curve: of a single count near 0 or 1 they are too small, and ranges too
   narrow. Fewer than three readings have no curve. */
static inline blocking_status fit_counts(const blocking_fit_def *def, const double *t, const double *free_holes,
                                         const double *holes, size_t n, double *f, double *sigma,
                                         blocking_fit_result *fit) {
    static size_t count[2][BLOCKING_TEST_ROWS];
    for (size_t i = 0; i < n; i++) {
        if (!(holes[i] > 0.0 && holes[i] <= 1e9 && free_holes[i] >= 0.0 && free_holes[i] <= holes[i] &&
              holes[i] == floor(holes[i]) && free_holes[i] == floor(free_holes[i])))
            return BLOCKING_BAD_COUNT;
        count[0][i] = (size_t)free_holes[i], count[1][i] = (size_t)holes[i];
        f[i] = free_holes[i] / holes[i];
        sigma[i] = counting_error(free_holes[i], holes[i]);
    }
    return blocking_fit_holes(def, t, count[0], count[1], n, f, sigma, fit);
}

/* The law of the tests in the file of option --tests. Leaves with one line if the file is no good. */
static inline void read_blocking_law(const program *self, const char *path, blocking_law *law) {
    static blocking_test tests[BLOCKING_TESTS];
    static double t[BLOCKING_TEST_ROWS], f[BLOCKING_TEST_ROWS], sigma[BLOCKING_TEST_ROWS];
    const blocking_fit_def def = blocking_default_fit_def();
    blocking_fit_result unused;
    enum { TEST, TIME, FACTOR, HARD, MOISTURE, FREE, HOLES, FRACTION, COLUMNS };
    sheet data;
    char message[600];
    sheet_column c[COLUMNS] = {sheet_want("test", 't', true),      sheet_want("time", 'T', true),
                               sheet_want("K", '#', true),         sheet_want("x_h", 's', false),
                               sheet_want("moisture", 's', false), sheet_want("free_holes", '#', false),
                               sheet_want("holes", '#', false),    sheet_want("free_fraction", '%', false)};
    if (sheet_read(path, c, COLUMNS, &data, message, sizeof message) != 0) program_refuse(self, "tests", path, message);
    const bool counted = c[FREE].value && c[HOLES].value;
    if (!counted && !c[FRACTION].value) program_refuse(self, "tests", path, blocking_tests_file);
    if (data.rows > BLOCKING_TEST_ROWS) program_refuse(self, "tests", path, "a file with at most 20000 readings");
    int n = 0;
    for (int i = 0; i < data.rows; i++) {
        const char *name = data.cell[i * data.columns + c[TEST].index];
        const double factor = c[FACTOR].value[i], hard = c[HARD].value ? c[HARD].value[i] : 0.5,
                     moisture = c[MOISTURE].value ? c[MOISTURE].value[i] : 0.0;
        if (i == 0 || strcmp(name, data.cell[(i - 1) * data.columns + c[TEST].index]) != 0) {
            if (n == BLOCKING_TESTS) program_refuse(self, "tests", path, "a file with at most 200 tests");
            tests[n].t = t + i, tests[n].f = f + i, tests[n].sigma = counted ? sigma + i : NULL;
            tests[n].n = 0;
            tests[n].K = factor, tests[n].x_h = hard, tests[n].moisture = moisture;
            n++;
        }
        const blocking_test *test = &tests[n - 1];
        if (factor != test->K || hard != test->x_h || moisture != test->moisture) {
            snprintf(message, sizeof message,
                     "line %d: K, x_h and moisture are those of a test, the same in all its rows", data.line[i]);
            refuse_file(self, "tests", path, blocking_tests_file, message);
        }
        t[i] = c[TIME].value[i];
        if (!counted) f[i] = c[FRACTION].value[i];
        tests[n - 1].n++;
    }
    size_t bad = 0, at = 0;
    blocking_status status = BLOCKING_OK;
    for (int k = 0; k < n && counted && status != BLOCKING_BAD_COUNT; at += tests[k++].n) {
        bad = (size_t)k;
        status =
            fit_counts(&def, t + at, c[FREE].value + at, c[HOLES].value + at, tests[k].n, f + at, sigma + at, &unused);
    }
    if (status != BLOCKING_BAD_COUNT) status = blocking_fit_law(tests, (size_t)n, law, &bad);
    sheet_free(&data);
    if (status == BLOCKING_OK) return;
    if (bad < (size_t)n) snprintf(message, sizeof message, "test %d: %s", (int)bad + 1, blocking_status_text(status));
    else snprintf(message, sizeof message, "%s", blocking_status_text(status));
    refuse_file(self, "tests", path, blocking_tests_file, message);
}

#endif
