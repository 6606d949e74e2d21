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

/* The law of the tests in the file of option --tests. Leaves with one line if the file is no good. */
static inline void read_blocking_law(const program *self, const char *path, blocking_law *law) {
    static blocking_test tests[BLOCKING_TESTS];
    static double t[BLOCKING_TEST_ROWS], f[BLOCKING_TEST_ROWS], sigma[BLOCKING_TEST_ROWS];
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
        if (i == 0 || strcmp(name, data.cell[(i - 1) * data.columns + c[TEST].index]) != 0) {
            if (n == BLOCKING_TESTS) program_refuse(self, "tests", path, "a file with at most 200 tests");
            tests[n].t = t + i, tests[n].f = f + i, tests[n].sigma = counted ? sigma + i : NULL;
            tests[n].n = 0;
            tests[n].K = c[FACTOR].value[i];
            tests[n].x_h = c[HARD].value ? c[HARD].value[i] : 0.5;
            tests[n].moisture = c[MOISTURE].value ? c[MOISTURE].value[i] : 0.0;
            n++;
        }
        const double holes = counted ? c[HOLES].value[i] : 1.0,
                     free_holes = counted ? c[FREE].value[i] : c[FRACTION].value[i];
        t[i] = c[TIME].value[i];
        f[i] = free_holes / holes;
        sigma[i] = counted ? counting_error(free_holes, holes) : 0.0;
        tests[n - 1].n++;
    }
    size_t bad;
    blocking_status status = blocking_fit_law(tests, (size_t)n, law, &bad);
    sheet_free(&data);
    if (status == BLOCKING_OK) return;
    snprintf(message, sizeof message, "test %d: %s", (int)bad + 1, blocking_status_text(status));
    refuse_file(self, "tests", path, blocking_tests_file, message);
}

#endif
