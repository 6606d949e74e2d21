/* data/screening_27_cases.csv, and that docs/screen_models.md and docs/batch_screening.md say what it gives. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "common.h"
#include "screen_models.h"

enum { CASES = 27, CLASSES = 2, TIMES = 40, POINTS = CLASSES * TIMES, SEEDS = 3 };

static const double diameters[CLASSES] = {0.005, 0.007};
static const double amplitudes[3] = {0.0008, 0.001, 0.0012}, frequencies[3] = {45.8, 50.6, 55.4},
                    moistures[3] = {0.0, 0.025, 0.05};
static double time_s[TIMES], retained[CASES][POINTS]; /* means over the seeds, every 0.5 s to 20 s */
static screen_case cases[CASES];
static screen_def def;

static int read_data(void **state) {
    csv_data data;
    char message[300];
    (void)state;
    if (csv_read("data/screening_27_cases.csv", &data, message, (int)sizeof message)) {
        print_message("%s\n", message);
        return -1;
    }
    for (int row = 0; row < data.rows; row++) {
        const int k = (int)csv_value(&data, row, "case") - 1, j = (int)(2.0 * csv_value(&data, row, "time_s")) - 1;
        if (k < 0 || k >= CASES || j < 0 || j >= TIMES) continue;
        retained[k][j] += csv_value(&data, row, "retained_small") / SEEDS;
        retained[k][TIMES + j] += csv_value(&data, row, "retained_near_mesh") / SEEDS;
    }
    csv_free(&data);
    def = screen_default_def();
    def.classes = CLASSES;
    def.diameters = diameters;
    def.ratio = SCREEN_RATIO_RETAINED;
    for (int j = 0; j < TIMES; j++) time_s[j] = 0.5 * (j + 1);
    for (int k = 0; k < CASES; k++) {
        const screen_operation operation = {amplitudes[k / 3 % 3], frequencies[k % 3], moistures[k / 9], 0.0};
        cases[k].operation = operation;
        cases[k].times = TIMES;
        cases[k].time = time_s;
        cases[k].retained = retained[k];
    }
    return 0;
}

static double deviation_of(screen_model model, const double *parameters, int k) {
    double curve[POINTS];
    assert_int_equal(screen_predict(&def, model, parameters, &cases[k].operation, TIMES, time_s, curve, NULL, NULL),
                     SCREEN_OK);
    return screen_deviation(POINTS, curve, retained[k]);
}

static double mean_deviation(screen_model model, const double *parameters) {
    double sum = 0.0;
    for (int k = 0; k < CASES; k++) sum += deviation_of(model, parameters, k) / CASES;
    return sum;
}

/* The numbers of a page's table row that begins with "| name |", bold or not. Returns how many. */
static int row_of(const char *page, const char *name, int most, double *numbers) {
    char line[1000], start[100];
    int n = 0;
    FILE *file = fopen(page, "r");
    assert_non_null(file);
    snprintf(start, sizeof start, "| %s |", name);
    while (n == 0 && fgets(line, sizeof line, file)) {
        if (strncmp(line, start, strlen(start)) != 0) continue;
        for (char *cell = strtok(line + strlen(start), "|\n"); cell && n < most; cell = strtok(NULL, "|\n"))
            numbers[n++] = strtod(cell, NULL);
    }
    fclose(file);
    return n;
}

/* Every row once, and of each case the operation of table 5. */
static void the_data_are_whole(void **state) {
    csv_data data;
    char message[300];
    int seen[CASES][SEEDS] = {{0}};
    (void)state;
    assert_int_equal(csv_read("data/screening_27_cases.csv", &data, message, (int)sizeof message), 0);
    assert_int_equal(data.rows, CASES * SEEDS * (TIMES + 1));
    for (int row = 0; row < data.rows; row++) {
        const int k = (int)csv_value(&data, row, "case") - 1, q = (int)csv_value(&data, row, "seed") - 1;
        assert_true(k >= 0 && k < CASES && q >= 0 && q < SEEDS);
        assert_true(fabs(csv_value(&data, row, "amplitude_m") - cases[k].operation.amplitude) < 1e-12);
        assert_true(fabs(csv_value(&data, row, "frequency_hz") - cases[k].operation.frequency) < 1e-12);
        assert_true(fabs(csv_value(&data, row, "moisture") - cases[k].operation.moisture) < 1e-12);
        assert_true(csv_value(&data, row, "time_s") == 0.5 * seen[k][q]++);
    }
    for (int k = 0; k < CASES; k++)
        for (int q = 0; q < SEEDS; q++) assert_int_equal(seen[k][q], TIMES + 1);
    csv_free(&data);
    assert_int_equal(screen_check_cases(&def, CASES, cases, 0.02, NULL), SCREEN_OK);
}

static void the_page_has_the_deviations_of_the_published_parameters(void **state) {
    static const char *const names[4] = {"", "1 Dong", "2 Subasinghe", "3 Soldinger"};
    (void)state;
    for (int m = 1; m < 4; m++) {
        double stated, p[SCREEN_MAX_PARAMETERS];
        assert_int_equal(row_of("docs/screen_models.md", names[m], 1, &stated), 1);
        assert_int_equal(screen_published((screen_model)m, p), SCREEN_OK);
        assert_true(fabs(mean_deviation((screen_model)m, p) - stated) < 0.51e-4);
    }
}

/* The parameters as printed; and models 0 to 2 fitted again (model 3 takes seconds). */
static void the_page_has_the_fits(void **state) {
    static const char *const names[4] = {"0 first order", "1 Dong", "2 Subasinghe", "3 Soldinger"};
    static const char *const rows[4] = {"0 first order: k, alpha, gamma", "1 Dong: k, alpha, gamma",
                                        "2 Subasinghe: k_s, alpha, gamma, k_p, beta, delta",
                                        "3 Soldinger: k_s, alpha, gamma, k_p, beta, delta"};
    (void)state;
    for (int m = 0; m < 4; m++) {
        const int n = m < 2 ? 3 : 6;
        double stated[2], p[SCREEN_MAX_PARAMETERS];
        assert_int_equal(row_of("docs/screen_models.md", names[m], 2, stated), 2);
        assert_int_equal(row_of("docs/screen_models.md", rows[m], n, p), n);
        assert_true(fabs(mean_deviation((screen_model)m, p) - stated[1]) < 0.51e-4);
        if (m == SCREEN_SOLDINGER) continue;
        screen_fit_options options = screen_default_fit_options((screen_model)m);
        screen_fit_result fit;
        options.data_tolerance = 0.02;
        options.starts = 5;
        assert_int_equal(screen_fit(&def, (screen_model)m, CASES, cases, &options, &fit), SCREEN_OK);
        assert_int_equal(fit.starts_at_best, 5);
        assert_true(fabs(fit.deviation - stated[1]) < 0.51e-4);
        assert_true(fabs(mean_deviation((screen_model)m, fit.parameter) - fit.deviation) < 1e-12);
    }
}

/* Fits as good as a global search, within 1e-4, and on the page as they are now; of model 3 at the
   parameters as printed. */
static void the_page_has_the_fits_beside_the_searches(void **state) {
    static const char *const rows[4] = {"fit and search: 1 Dong", "fit and search: 1 Dong, grain",
                                        "fit and search: 2 Subasinghe", "fit and search: 3 Soldinger"};
    static const screen_model models[4] = {SCREEN_DONG, SCREEN_DONG, SCREEN_SUBASINGHE, SCREEN_SOLDINGER};
    (void)state;
    for (int i = 0; i < 4; i++) {
        double stated[3], p[SCREEN_MAX_PARAMETERS];
        assert_int_equal(row_of("docs/screen_models.md", rows[i], 3, stated), 3);
        assert_true(stated[0] - stated[1] < 1e-4 && stated[2] == 1e6);
        if (models[i] == SCREEN_SOLDINGER) {
            assert_int_equal(row_of("docs/screen_models.md", "3 Soldinger: k_s, alpha, gamma, k_p, beta, delta", 6, p),
                             6);
            assert_true(fabs(mean_deviation(SCREEN_SOLDINGER, p) - stated[0]) < 2e-6);
            continue;
        }
        screen_def deck = def;
        screen_fit_options options = screen_default_fit_options(models[i]);
        screen_fit_result fit;
        deck.ratio = i == 1 ? SCREEN_RATIO_GRAIN : SCREEN_RATIO_RETAINED;
        options.data_tolerance = 0.02;
        options.starts = 5;
        assert_int_equal(screen_fit(&deck, models[i], CASES, cases, &options, &fit), SCREEN_OK);
        assert_true(fit.deviation - stated[0] < 0.6e-7 && stated[0] - fit.deviation < 5e-7);
    }
}

/* The 18 cases with A = 1.0 and 1.2 mm lie near the paper's model 2; with 0.8 mm, dry, the screen stagnates, which no
   set of it can. */
static void the_study_lies_near_the_paper_where_the_screen_empties(void **state) {
    double p[SCREEN_MAX_PARAMETERS], sum = 0.0, stated[2];
    (void)state;
    screen_published(SCREEN_SUBASINGHE, p);
    for (int k = 0; k < CASES; k++)
        if (k / 3 % 3 > 0) sum += deviation_of(SCREEN_SUBASINGHE, p, k) / 18.0;
    assert_int_equal(row_of("docs/batch_screening.md", "model 2", 2, stated), 2);
    assert_true(fabs(sum - stated[1]) < 0.51e-4);
    assert_true(sum < 0.06);
    for (int k = 0; k < 3; k++) assert_true(retained[k][POINTS - 1] > 0.02);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_data_are_whole),
        cmocka_unit_test(the_page_has_the_deviations_of_the_published_parameters),
        cmocka_unit_test(the_page_has_the_fits),
        cmocka_unit_test(the_page_has_the_fits_beside_the_searches),
        cmocka_unit_test(the_study_lies_near_the_paper_where_the_screen_empties),
    };
    return cmocka_run_group_tests(tests, read_data, NULL);
}
