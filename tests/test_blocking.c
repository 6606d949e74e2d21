/* blocking.h against the numbers of the source paper, closed forms and 40-digit calculations
   (tests/reference/blocking_curves.csv). */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "near.h"

#include "blocking.h"
#include "../examples/common/random.h"

#define LENGTH(array) (sizeof(array) / sizeof((array)[0]))

static const double nan_ = (double)NAN;

#undef near
#define near(got, wanted, tolerance)                                                                                   \
    near_absolute(got, wanted, (tolerance)*fmax(fabs((double)(wanted)), 1.0), NEAR_PLACE)

/* Table 2: f = f_inf + A exp(-k t), and what section 4 of the specification says of it; the row 8b experimental
   is the paper's */
static const struct {
    const char *row;
    double f_inf, A, k, start, at_30, mean_60;
} table2[] = {
    {"7a experimental", .960, .0209, .0421, .9809, .965910610697387, .967612214428014},
    {"7a model", .961, .0210, .0353, .9820, .968282851227947, .969722516255038},
    {"7b experimental", .714, .235, .0101, .9490, .887570787647063, .890238899484432},
    {"7b model", .704, .257, .00667, .9610, .914392763212721, .915799598135911},
    {"8a experimental", .909, -.214, .0234, .6950, .802943071101773, .794015017730795},
    {"8a model", .932, -.301, .0433, .6310, .849885857197349, .824764089483879},
    {"8b experimental", .960, -.0907, .0119, .8693, .89653063445547078, .89517383257244576},
    {"8b model", .965, -.072, .0197, .8930, .925128327114484, .922766383468339},
};

static void grains_and_vibration(void **state) {
    (void)state;
    near(blocking_relative_size(0.0008, 0.001), 0.8, 1e-15);
    assert_true(isnan(blocking_relative_size(-1.0, 1.0)) && isnan(blocking_relative_size(1.0, 0.0)) &&
                isnan(blocking_relative_size(nan_, 1.0)) && isnan(blocking_relative_size(1.0, HUGE_VAL)));
    const double openings[] = {0.5e-3, 0.63e-3, 0.8e-3, 1e-3, 1.2e-3};
    for (size_t i = 0; i < LENGTH(openings); i++) { /* both ends belong to it, whatever the rounding of the quotient */
        double l = openings[i];
        assert_true(blocking_is_hard_to_screen(blocking_relative_size(0.8 * l, l)) &&
                    blocking_is_hard_to_screen(blocking_relative_size(1.2 * l, l)));
        assert_false(blocking_is_hard_to_screen(0.7999999 * l / l) || blocking_is_hard_to_screen(1.2000001 * l / l));
    }
    assert_false(blocking_is_hard_to_screen(nan_) || blocking_is_hard_to_screen(HUGE_VAL) ||
                 blocking_is_hard_to_screen(1e-300));

    const double pi = 3.14159265358979323846, n = 70.0 / 3.0;
    near(blocking_toss_indicator(n, 0.7e-3, pi / 2, 15 * pi / 180, 9.81), 1.58781010617546, 1e-12);
    close_to(blocking_toss_amplitude(1.5, n, 15 * pi / 180, 9.81), 6.61288145173179e-4, 1e-14);
    close_to(blocking_toss_frequency(1.58781010617546242, 0.7e-3, pi / 2, 15 * pi / 180, 9.81), n, 1e-14);
    near(blocking_toss_indicator(50.6, 1e-3, pi / 2, 0.0, 9.81), 4 * pi * pi * 50.6 * 50.6 * 1e-3 / 9.81, 1e-14);
    close_to(blocking_toss_indicator(20.0, 1e-3, pi / 6, 0.0, 9.81),
             0.5 * blocking_toss_indicator(20.0, 1e-3, pi / 2, 0.0, 9.81), 1e-14);
    near(blocking_toss_indicator(0.0, 1e-3, 1.0, 0.0, 9.81), 0.0, 0.0);
    assert_true(isnan(blocking_toss_indicator(n, 1e-3, 1.0, pi / 2, 9.81)) &&
                isnan(blocking_toss_indicator(n, 1e-3, 1.0, 2.0, 9.81)) &&
                isnan(blocking_toss_indicator(-1.0, 1e-3, 1.0, 0.0, 9.81)) &&
                isnan(blocking_toss_indicator(n, -1e-3, 1.0, 0.0, 9.81)) &&
                isnan(blocking_toss_indicator(n, 1e-3, -1.0, 0.0, 9.81)) &&
                isnan(blocking_toss_indicator(n, 1e-3, 1.0, 0.0, 0.0)) &&
                isnan(blocking_toss_indicator(nan_, 1e-3, 1.0, 0.0, 9.81)) &&
                isnan(blocking_toss_indicator(n, 1e-3, 1.0, 0.0, nan_)));
    assert_true(isnan(blocking_toss_amplitude(-1.0, n, 0.0, 9.81)) &&
                isnan(blocking_toss_amplitude(1.0, 0.0, 0.0, 9.81)));
    assert_true(isnan(blocking_toss_frequency(1.0, 1e-3, 0.0, 0.0, 9.81)) &&
                isnan(blocking_toss_frequency(1.0, 0.0, 1.0, 0.0, 9.81)) &&
                isnan(blocking_toss_frequency(nan_, 1e-3, 1.0, 0.0, 9.81)));

    const struct {
        double K;
        blocking_toss row;
    } rows[] = {{0.0, BLOCKING_TOSS_NONE},      {0.62, BLOCKING_TOSS_NONE},      {1.0, BLOCKING_TOSS_UNLISTED},
                {1.98, BLOCKING_TOSS_UNLISTED}, {2.0, BLOCKING_TOSS_EASY},       {3.3, BLOCKING_TOSS_EASY},
                {3.31, BLOCKING_TOSS_UNLISTED}, {4.5, BLOCKING_TOSS_AVERAGE},    {6.5, BLOCKING_TOSS_AVERAGE},
                {6.9, BLOCKING_TOSS_UNLISTED},  {7.0, BLOCKING_TOSS_HARD},       {10.0, BLOCKING_TOSS_HARD},
                {10.1, BLOCKING_TOSS_UNLISTED}, {-0.1, BLOCKING_TOSS_UNDEFINED}, {nan_, BLOCKING_TOSS_UNDEFINED}};
    for (size_t i = 0; i < LENGTH(rows); i++) assert_int_equal(blocking_toss_range(rows[i].K), rows[i].row);
}

static void hard_content(void **state) {
    (void)state;
    blocking_hard h;
    const double d[] = {0.4e-3, 0.504e-3, 0.63e-3, 0.7e-3, 0.756e-3, 0.8e-3}, m[] = {1, 2, 3, 4, 5, 5};
    assert_int_equal(blocking_hard_from_classes(d, m, 6, 0.63e-3, &h), BLOCKING_OK);
    near(h.below, 5.0 / 20, 1e-15); /* 0.8 l and l itself */
    near(h.above, 9.0 / 20, 1e-15); /* 1.2 l belongs to it */
    near(h.x_h, 14.0 / 20, 1e-15);
    double bad[6];
    memcpy(bad, m, sizeof bad);
    bad[2] = nan_;
    assert_int_equal(blocking_hard_from_classes(d, bad, 6, 0.63e-3, &h), BLOCKING_NOT_FINITE);
    assert_true(isnan(h.x_h));
    bad[2] = -1.0;
    assert_int_equal(blocking_hard_from_classes(d, bad, 6, 0.63e-3, &h), BLOCKING_NEGATIVE);
    const double zero[] = {0, 0, 0, 0, 0, 0};
    assert_int_equal(blocking_hard_from_classes(d, zero, 6, 0.63e-3, &h), BLOCKING_TOO_FEW);
    assert_int_equal(blocking_hard_from_classes(NULL, NULL, 0, 0.63e-3, &h), BLOCKING_TOO_FEW);
    assert_int_equal(blocking_hard_from_classes(NULL, m, 6, 0.63e-3, &h), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_hard_from_classes(d, m, 6, 0.0, &h), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_hard_from_classes(d, m, 6, nan_, &h), BLOCKING_NOT_FINITE);
    assert_int_equal(blocking_hard_from_classes(d, m, 6, 0.63e-3, NULL), BLOCKING_BAD_ARGUMENT);
    const double tiny[] = {1e-300}, one[] = {1e-300};
    assert_int_equal(blocking_hard_from_classes(tiny, one, 1, 1e-300, &h), BLOCKING_OK);
    near(h.below, 1.0, 0.0);

    /* a uniform distribution from 0 to 2 l: 0.2 l of 2 l on either side */
    const double size[] = {0.0, 1e-3, 2e-3}, passing[] = {0.0, 0.5, 1.0};
    assert_int_equal(blocking_hard_from_curve(size, passing, 3, 1e-3, &h), BLOCKING_OK);
    near(h.below, 0.1, 1e-15);
    near(h.above, 0.1, 1e-15);
    near(h.x_h, 0.2, 1e-15);
    assert_int_equal(blocking_hard_from_curve(size, passing, 3, 5e-3, &h), BLOCKING_OK); /* all finer */
    near(h.x_h, 0.0, 0.0);
    const double part[] = {0.0, 0.5, 0.9};
    assert_int_equal(blocking_hard_from_curve(size, part, 3, 1e-3, &h), BLOCKING_OK);
    assert_int_equal(blocking_hard_from_curve(size, part, 3, 1.9e-3, &h), BLOCKING_NOT_COVERED);
    const double from[] = {0.9e-3, 1e-3, 2e-3}, offset[] = {0.2, 0.5, 1.0};
    assert_int_equal(blocking_hard_from_curve(from, offset, 3, 1e-3, &h), BLOCKING_NOT_COVERED);
    const double percent[] = {0.0, 50.0, 100.0}, falling[] = {0.0, 0.7, 0.6}, minus[] = {-0.1, 0.7, 1.0},
                 unknown[] = {0.0, nan_, 1.0};
    assert_int_equal(blocking_hard_from_curve(size, percent, 3, 1e-3, &h), BLOCKING_IN_PERCENT);
    assert_int_equal(blocking_hard_from_curve(size, falling, 3, 1e-3, &h), BLOCKING_NOT_CUMULATIVE);
    assert_int_equal(blocking_hard_from_curve(size, minus, 3, 1e-3, &h), BLOCKING_NEGATIVE);
    assert_int_equal(blocking_hard_from_curve(size, unknown, 3, 1e-3, &h), BLOCKING_NOT_FINITE);
    assert_int_equal(blocking_hard_from_curve(passing, size, 1, 1e-3, &h), BLOCKING_TOO_FEW);
    const double twice[] = {0.0, 1e-3, 1e-3};
    assert_int_equal(blocking_hard_from_curve(twice, passing, 3, 1e-3, &h), BLOCKING_NOT_RISING);
    assert_int_equal(blocking_hard_from_curve(NULL, passing, 3, 1e-3, &h), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_hard_from_curve(size, passing, 3, -1.0, &h), BLOCKING_BAD_ARGUMENT);
}

static void counted_holes(void **state) {
    (void)state;
    blocking_count c;
    const size_t free_holes[] = {70, 72, 66, 73}, holes[] = {100, 100, 100, 100};
    assert_int_equal(blocking_count_holes(free_holes, holes, 4, 1.96, &c), BLOCKING_OK);
    near(c.free_fraction, 281.0 / 400, 1e-15);
    near(c.blocked, 119.0 / 400, 1e-15);
    near(c.standard_error, 0.022857917118582787, 1e-15);
    near(c.low, 0.65594418097729173, 1e-14);
    near(c.high, 0.7452031995798376, 1e-14);
    near(c.spot_error, sqrt((0.0025 * 0.0025 + 0.0175 * 0.0175 + 0.0425 * 0.0425 + 0.0275 * 0.0275) / 3.0 / 4.0),
         1e-14);
    const size_t all[] = {400}, none[] = {0}, spot[] = {400}, most[] = {384}, some[] = {280}, zero[] = {0},
                 more[] = {401};
    assert_int_equal(blocking_count_holes(most, spot, 1, 1.96, &c), BLOCKING_OK);
    near(c.standard_error, 0.0098, 5e-5); /* "s = 0.0098 (f=.96), 0.0229 (f=.7)" */
    assert_true(isnan(c.spot_error));
    assert_int_equal(blocking_count_holes(some, spot, 1, 1.96, &c), BLOCKING_OK);
    near(c.standard_error, 0.0229, 5e-5);
    assert_int_equal(blocking_count_holes(all, spot, 1, 1.96, &c), BLOCKING_OK);
    assert_true(c.free_fraction == 1.0 && c.blocked == 0.0 && c.high == 1.0 && c.low < 1.0 && c.low > 0.98);
    assert_int_equal(blocking_count_holes(none, spot, 1, 1.96, &c), BLOCKING_OK);
    assert_true(c.free_fraction == 0.0 && c.low == 0.0 && c.high > 0.0 && c.high < 0.02);
    assert_int_equal(blocking_count_holes(more, spot, 1, 1.96, &c), BLOCKING_BAD_COUNT);
    assert_int_equal(blocking_count_holes(zero, zero, 1, 1.96, &c), BLOCKING_BAD_COUNT);
    assert_int_equal(blocking_count_holes(NULL, NULL, 0, 1.96, &c), BLOCKING_TOO_FEW);
    assert_int_equal(blocking_count_holes(NULL, spot, 1, 1.96, &c), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_count_holes(all, spot, 1, nan_, &c), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_count_holes(all, spot, 1, 1.96, NULL), BLOCKING_BAD_ARGUMENT);
    const double beyond[] = {1.01e6, 1e160, 1e300, HUGE_VAL, 0.0, -1.0}; /* the square of z overflows: no interval */
    for (size_t i = 0; i < LENGTH(beyond); i++) {
        assert_int_equal(blocking_count_holes(some, spot, 1, beyond[i], &c), BLOCKING_BAD_ARGUMENT);
        assert_true(isnan(c.low) && isnan(c.high));
    }
    assert_int_equal(blocking_count_holes(some, spot, 1, 1e6, &c), BLOCKING_OK);
    assert_true(c.low >= 0.0 && c.low < 1e-6 && c.high > 1.0 - 1e-6 && c.high <= 1.0);

    assert_false(blocking_bed_too_thick(0.0, 0.2) || blocking_bed_too_thick(0.0199, 0.2));
    assert_true(blocking_bed_too_thick(0.02, 0.2) && blocking_bed_too_thick(0.03, 0.3) &&
                blocking_bed_too_thick(1.0, 0.2));
    assert_true(blocking_bed_too_thick(nan_, 0.2) && blocking_bed_too_thick(0.01, 0.0) &&
                blocking_bed_too_thick(-0.01, 0.2));
}

static void curves_of_table_2(void **state) {
    (void)state;
    for (size_t i = 0; i < LENGTH(table2); i++) {
        double f0 = table2[i].f_inf + table2[i].A;
        near(f0, table2[i].start, 1e-15);
        near(blocking_curve(f0, table2[i].f_inf, table2[i].k, 0.0), table2[i].start, 1e-15);
        near(blocking_curve(f0, table2[i].f_inf, table2[i].k, 30.0), table2[i].at_30, 1e-14);
        near(blocking_time_mean(f0, table2[i].f_inf, table2[i].k, 60.0), table2[i].mean_60, 1e-14);
        double k1 = blocking_k1(table2[i].f_inf, table2[i].k), k2 = blocking_k2(table2[i].f_inf, table2[i].k);
        near(blocking_equilibrium(k1, k2), table2[i].f_inf, 1e-15);
        near(blocking_free_fraction(f0, k1, k2, 30.0), table2[i].at_30, 1e-14);
    }
    const struct { double most, at; } difference[] = {{.002393, 25}, {.036353, 95}, {.064, 0}, {.028672, 35}};
    for (size_t i = 0; i < 4; i++) {
        double most = -1.0, at = 0.0;
        for (int t = 0; t <= 2048; t += 5) {
            double a = blocking_curve(table2[2 * i].start, table2[2 * i].f_inf, table2[2 * i].k, t);
            double b = blocking_curve(table2[2 * i + 1].start, table2[2 * i + 1].f_inf, table2[2 * i + 1].k, t);
            if (fabs(a - b) > most) {
                most = fabs(a - b);
                at = t;
            }
        }
        near(most, difference[i].most, 5e-7);
        near(at, difference[i].at, 0.0);
    }
    near(blocking_equilibrium(.004, .016), 0.8, 1e-15);
    near(blocking_free_fraction(.95, .004, .016, 50.0), 0.855181916175716, 1e-14);
    near(blocking_pure_blocking(.95, .004, 50.0), 0.777794215424083, 1e-14);
    near(blocking_pure_unblocking(.95, .016, 50.0), 0.977533551794139, 1e-14);
    near(blocking_rate(.95, .004, .016), -.004 * .95 + .016 * .05, 1e-16);
}

static void curves_to_the_last_digits(void **state) {
    (void)state;
    FILE *file = fopen("tests/reference/blocking_curves.csv", "r");
    if (!file) fail_msg("run in the root of the repository: tests/reference/blocking_curves.csv is not there");
    char line[400];
    int rows = 0;
    double f0, f_inf, k, t, f, mean, exposure;
    while (fgets(line, sizeof line, file)) {
        if (sscanf(line, "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &f0, &f_inf, &k, &t, &f, &mean, &exposure) != 7) continue;
        close_to(blocking_curve(f0, f_inf, k, t), f, 1e-14 + 3e-16 * k * t);
        close_to(blocking_time_mean(f0, f_inf, k, t), mean, 4e-15);
        close_to(blocking_exposure(f0, f_inf, k, t), exposure, 4e-15);
        rows++;
    }
    fclose(file);
    assert_int_equal(rows, 137);
}

static void invariants(void **state) {
    (void)state;
    uint64_t seed = 7;
    for (int i = 0; i < 200000; i++) {
        double f0 = random_plain(&seed), k1 = exp(20 * random_plain(&seed) - 14),
               k2 = exp(20 * random_plain(&seed) - 14);
        double t = exp(24 * random_plain(&seed) - 12), s = exp(24 * random_plain(&seed) - 12);
        if (i % 17 == 0) k1 = 0.0;
        if (i % 13 == 0) k2 = 0.0;
        if (i % 11 == 0) f0 = i % 2;
        double f = blocking_free_fraction(f0, k1, k2, t), f_inf = k1 + k2 > 0.0 ? k2 / (k1 + k2) : f0;
        if (!(f >= fmin(f0, f_inf) && f <= fmax(f0, f_inf)))
            fail_msg("f leaves [f0, f_inf]: %g %g %g %g", f0, k1, k2, t);
        near(blocking_free_fraction(f, k1, k2, s), blocking_free_fraction(f0, k1, k2, t + s), 2e-15); /* semigroup */
        /* holes free <-> blocked */
        near(1.0 - blocking_free_fraction(1.0 - f0, k2, k1, t), f, 5e-16);
        if (k1 == 0.0) near(f, 1.0 - (1.0 - f0) * exp(-k2 * t), 1e-15);                               /* eq 8 */
        if (k2 == 0.0) near(f, f0 * exp(-k1 * t), 1e-15);                                             /* eq 6 */
        double mean = blocking_time_mean(f0, f_inf, k1 + k2, t), later = blocking_time_mean(f, f_inf, k1 + k2, s);
        if (!(mean >= fmin(f0, f) - 1e-15 && mean <= fmax(f0, f) + 1e-15))
            fail_msg("mean outside the curve: %g %g %g %g", f0, k1, k2, t);
        near(blocking_time_mean(f0, f_inf, k1 + k2, t + s), (t * mean + s * later) / (t + s), 3e-15); /* means add up */
        double x = (k1 + k2) * t;
        /* time back from the value; what the value itself does not hold is allowed for */
        if (x < 20.0 && fabs(f - f0) > 1e-8) {
            double lost = DBL_EPSILON / fabs(f - f_inf) / x;
            if (lost < 1e-4)
                close_to(blocking_time_to(f, f0, f_inf, k1 + k2), t, 1e-14 + 4 * lost + 1e-15 / fabs(f - f0));
        }
        double exposure = mean * t;
        if (exposure > 1e-12 && f > 1e-6) {
            double back = blocking_time_for_exposure(exposure, f0, f_inf, k1 + k2);
            close_to(blocking_exposure(f0, f_inf, k1 + k2, back), exposure, 1e-14);
            if (mean > 1e-3 && f > 0.01) close_to(back, t, 1e-12);
        }
    }
}

static void degenerate_curves(void **state) {
    (void)state;
    near(blocking_free_fraction(0.37, 0.0, 0.0, 1e9), 0.37, 0.0);
    near(blocking_free_fraction(0.37, 0.0, 0.0, HUGE_VAL), 0.37, 0.0);
    near(blocking_free_fraction(0.37, 1.0, 3.0, HUGE_VAL), 0.75, 1e-16);
    near(blocking_free_fraction(0.37, 1e-300, 0.0, 1e-300), 0.37, 0.0);
    assert_true(isnan(blocking_equilibrium(0.0, 0.0)) && isnan(blocking_equilibrium(-1.0, 2.0)) &&
                isnan(blocking_equilibrium(nan_, 1.0)));
    assert_true(isnan(blocking_free_fraction(1.1, 1, 1, 1)) && isnan(blocking_free_fraction(nan_, 1, 1, 1)) &&
                isnan(blocking_free_fraction(.5, -1, 1, 1)) && isnan(blocking_free_fraction(.5, 1, nan_, 1)) &&
                isnan(blocking_free_fraction(.5, 1, 1, -1)) && isnan(blocking_free_fraction(.5, 1, 1, nan_)) &&
                isnan(blocking_free_fraction(.5, HUGE_VAL, 1, 1)));
    assert_true(isnan(blocking_rate(1.5, 1, 1)) && isnan(blocking_rate(.5, nan_, 1)) && isnan(blocking_k1(1.5, 1)) &&
                isnan(blocking_k2(.5, -1)));
    assert_true(isnan(blocking_curve(nan_, 1, 1, 1)) && isnan(blocking_curve(1, HUGE_VAL, 1, 1)) &&
                isnan(blocking_time_mean(1, 1, 1, -1)) && isnan(blocking_time_mean(1, 1, nan_, 1)));
    near(blocking_curve(2.0, -1.0, 0.5, 2.0), -1.0 + 3.0 * exp(-1.0), 1e-15); /* a fitted curve may leave 0..1 */
    near(blocking_time_mean(0.9, 0.2, 0.5, HUGE_VAL), 0.2, 0.0);
    near(blocking_time_mean(0.9, 0.2, 0.5, 0.0), 0.9, 0.0);
    near(blocking_time_mean(0.9, 0.2, 0.0, 5.0), 0.9, 0.0);
    near(blocking_time_mean(0.9, 0.2, 1e-12, 1.0), 0.9 - 0.7 * 0.5e-12, 1e-16);

    near(blocking_time_to(0.9, 0.9, 0.2, 0.5), 0.0, 0.0);
    near(blocking_time_to(0.55, 0.9, 0.2, 0.5), log(2.0) / 0.5, 1e-15);
    assert_true(isnan(blocking_time_to(0.2, 0.9, 0.2, 0.5)) && isnan(blocking_time_to(0.1, 0.9, 0.2, 0.5)) &&
                isnan(blocking_time_to(0.95, 0.9, 0.2, 0.5)) && isnan(blocking_time_to(0.5, 0.9, 0.2, 0.0)) &&
                isnan(blocking_time_to(nan_, 0.9, 0.2, 0.5)));

    /* 0.9 / 0.05 = 18 s of clean deck is all it gives */
    assert_true(isinf(blocking_time_for_exposure(19.0, 0.9, 0.0, 0.05)));
    near(blocking_exposure(0.9, 0.0, 0.05, HUGE_VAL), 18.0, 1e-15);
    /* k t and k1 + k2 beyond the largest double */
    for (double t = 1e290; t < HUGE_VAL; t *= 3.0) {
        close_to(blocking_exposure(1.0, 0.0, 1e10, t), 1e-10, 4e-16);
        close_to(blocking_exposure(1.0, 0.5, 1e10, t), 0.5 * t, 4e-16);
    }
    assert_true(blocking_equilibrium(1e308, 1e308) == 0.5 && blocking_equilibrium(0.0, 1.7e308) == 1.0);
    assert_true(blocking_free_fraction(1.0, 1e308, 1e308, 1.0) == 0.5);
    close_to(blocking_free_fraction(1.0, 1e308, 1e308, 5e-309), 0.5 + 0.5 * exp(-1.0), 1e-14);
    assert_true(isnan(blocking_free_fraction(1.0, HUGE_VAL, 1.0, 1.0)));
    near(blocking_exposure(0.9, 0.0, 0.05, blocking_time_for_exposure(17.0, 0.9, 0.0, 0.05)), 17.0, 1e-14);
    near(blocking_time_for_exposure(3.0, 0.6, 0.6, 0.05), 5.0, 1e-15);
    near(blocking_time_for_exposure(3.0, 0.6, 0.1, 0.0), 5.0, 1e-15);
    near(blocking_time_for_exposure(0.0, 0.0, 0.1, 1.0), 0.0, 0.0);
    assert_true(isinf(blocking_time_for_exposure(1.0, 0.0, 0.1, 0.0)));
    close_to(blocking_time_for_exposure(2.0, 0.0, 1.0, 1e-300), 2e150, 1e-12); /* exposure k t^2 / 2 */
    assert_true(isnan(blocking_time_for_exposure(-1.0, .5, .5, 1)) &&
                isnan(blocking_time_for_exposure(1, 1.5, .5, 1)) && isnan(blocking_time_for_exposure(1, .5, nan_, 1)) &&
                isnan(blocking_time_for_exposure(nan_, .5, .5, 1)));
}

/* ---- changing rates ---- */

typedef struct changing {
    int kind;
    double at;
} changing;

static void rates(void *user, double t, double *k1, double *k2) {
    const changing *l = (const changing *)user;
    *k1 = 0.004;
    *k2 = 0.016;
    switch (l->kind) {
    case 1: /* 40-digit reference below */
        *k1 = 0.02 * (1.0 + 0.5 * sin(0.3 * t));
        *k2 = 0.01 * exp(-t / 40.0);
        break;
    case 2: /* jump */
        *k1 = t < l->at ? 0.5 : 0.001;
        *k2 = t < l->at ? 0.0 : 0.3;
        break;
    case 3: *k2 = nan_; break;
    case 4: *k1 = -0.1; break;
    case 5: /* steep: far more than a factor 14 within a step */
        *k1 = t * t * t * t;
        *k2 = 1e4 * exp(-5.0 * t);
        break;
    case 6: /* stiff */
        *k1 = 1e8;
        *k2 = 1e8 * (1.0 + sin(t));
        break;
    case 7: /* f = 0.5 + 0.4 sin t exactly: k2 = k1 f/(1-f) + f'/(1-f) with k1 = 2 */
        *k1 = 2.0;
        *k2 = (2.0 * (0.5 + 0.4 * sin(t)) + 0.4 * cos(t)) / (0.5 - 0.4 * sin(t));
        break;
    case 8: /* a period that divides the output times; from l->at on */
        *k1 = t < l->at ? 0.02 : 0.02 * (1.0 + 0.9 * cos(2.0 * 3.14159265358979323846 * t / 15.0));
        *k2 = 0.0;
        break;
    default: break;
    }
}

static void constant_rates_are_exact(void **state) {
    (void)state;
    changing l = {0, 0.0};
    blocking_ode_def def = blocking_default_ode_def();
    def.f0 = 0.95;
    def.rates = rates;
    def.user = &l;
    const double times[] = {0.0, 1.0, 50.0, 1e4};
    double f[4], mean[4];
    blocking_ode_report report;
    assert_int_equal(blocking_integrate(&def, times, 4, f, mean, &report), BLOCKING_OK);
    near(f[0], 0.95, 0.0);
    near(f[2], 0.855181916175716, 1e-14);
    for (int i = 0; i < 4; i++) {
        near(f[i], blocking_free_fraction(0.95, .004, .016, times[i]), 1e-15);
        near(mean[i], blocking_time_mean(0.95, 0.8, .02, times[i]), 2e-15);
    }
    assert_true(report.steps <= 12 && report.time == 1e4);
}

static void changing_rates(void **state) {
    (void)state;
    changing l = {1, 0.0};
    blocking_ode_def def = blocking_default_ode_def();
    def.rates = rates;
    def.user = &l;
    const double times[] = {10.0, 60.0};
    double f[2], mean[2], error[3];
    blocking_ode_report report;
    /* df/dt = -0.02 (1 + sin(0.3 t)/2) f + 0.01 exp(-t/40)(1 - f): 40 digits by quadrature */
    const double tolerances[] = {1e-6, 1e-9, 1e-12};
    size_t evaluations[3];
    for (int i = 0; i < 3; i++) {
        def.tolerance = tolerances[i];
        assert_int_equal(blocking_integrate(&def, times, 2, f, mean, &report), BLOCKING_OK);
        error[i] = fmax(fabs(f[0] - 0.775283749586458583), fabs(f[1] - 0.359833315540861278));
        assert_true(error[i] <= tolerances[i] && fabs(mean[1] - 0.59769180723933006) <= tolerances[i]);
        assert_true(report.error <= tolerances[i] + 1e-15 * (double)report.steps);
        evaluations[i] = report.evaluations;
    }
    assert_true(evaluations[2] > evaluations[0] && evaluations[2] < 20000);

    l.kind = 7; /* manufactured */
    def.f0 = 0.5;
    def.tolerance = 1e-11;
    const double two_pi[] = {1.0, 6.283185307179586};
    assert_int_equal(blocking_integrate(&def, two_pi, 2, f, mean, &report), BLOCKING_OK);
    near(f[0], 0.5 + 0.4 * sin(1.0), 2e-11);
    near(f[1], 0.5, 2e-11);
    near(mean[1], 0.5, 2e-11);

    l.kind = 5; /* rates over many orders: stays in 0..1, whatever the step */
    def.f0 = 0.0;
    for (int i = 0; i < 12; i++) {
        def.tolerance = pow(10.0, -1 - i);
        const double grid[] = {0.01, 0.5, 1.0, 3.0, 10.0, 30.0};
        double g[6];
        assert_int_equal(blocking_integrate(&def, grid, 6, g, NULL, NULL), BLOCKING_OK);
        for (int j = 0; j < 6; j++) assert_true(g[j] >= 0.0 && g[j] <= 1.0);
    }
    l.kind = 6; /* k t = 1e10: follows the equilibrium */
    def.f0 = 1.0;
    def.tolerance = 1e-4;
    const double hundred[] = {1.0, 100.0};
    assert_int_equal(blocking_integrate(&def, hundred, 2, f, mean, &report), BLOCKING_OK);
    near(f[0], (1.0 + sin(1.0)) / (2.0 + sin(1.0)), 1e-4);
    near(f[1], (1.0 + sin(100.0)) / (2.0 + sin(100.0)), 1e-4);
}

static void periodic_rates(void **state) {
    (void)state;
    changing l = {8, 0.0};
    blocking_ode_def def = blocking_default_ode_def();
    def.rates = rates;
    def.user = &l;
    const double times[] = {60.0, 120.0, 180.0};
    double f[3];
    for (int i = 0; i < 3; i++) { /* over whole periods only the mean 0.02 counts */
        l.at = 60.0 * i;
        assert_int_equal(blocking_integrate(&def, times, 3, f, NULL, NULL), BLOCKING_OK);
        for (int j = 0; j < 3; j++) near(f[j], exp(-0.02 * times[j]), 1e-10);
    }
}

static void jumps(void **state) {
    (void)state;
    changing l = {2, 7.3};
    blocking_ode_def def = blocking_default_ode_def();
    def.rates = rates;
    def.user = &l;
    const double times[] = {5.0, 20.0}, exact = blocking_free_fraction(exp(-0.5 * 7.3), 0.001, 0.3, 20.0 - 7.3);
    double f[2], mean[2];
    const double mean_exact = (7.3 * blocking_time_mean(1.0, 0.0, 0.5, 7.3) +
                               12.7 * blocking_time_mean(exp(-0.5 * 7.3), 0.3 / 0.301, 0.301, 12.7)) /
                              20.0;
    blocking_ode_report named, found;
    const double breaks[] = {-1.0, 7.3, 50.0};
    def.breaks = breaks;
    def.n_breaks = 3;
    assert_int_equal(blocking_integrate(&def, times, 2, f, mean, &named), BLOCKING_OK);
    near(f[1], exact, 1e-15);
    near(mean[1], mean_exact, 1e-15);
    def.n_breaks = 0; /* it finds the jump by itself, at a price */
    assert_int_equal(blocking_integrate(&def, times, 2, f, mean, &found), BLOCKING_OK);
    near(f[1], exact, 1e-10);
    near(mean[1], mean_exact, 1e-10);
    assert_true(found.evaluations > 3 * named.evaluations && found.evaluations < 3000);
}

/* the caller's law: more throw frees, more hard grains block */
static void throw_law(void *user, double K, double x_h, double *k1, double *k2) {
    (void)user;
    *k1 = 0.02 * x_h;
    *k2 = 0.005 * K;
}

static void schedules(void **state) {
    (void)state;
    const double time[] = {0.0, 10.0, 30.0}, K[] = {1.5, 3.5, 3.5}, x_h[] = {0.5, 0.5, 0.2};
    blocking_schedule s = {time, K, x_h, 3, 1, throw_law, NULL};
    blocking_ode_def def = blocking_default_ode_def();
    def.rates = blocking_schedule_rates;
    def.user = &s;
    def.breaks = time;
    def.n_breaks = 3;
    const double times[] = {10.0, 30.0, 40.0};
    double f[3];
    size_t row = 99;
    assert_int_equal(blocking_check_schedule(&s, &row), BLOCKING_OK);
    assert_int_equal(row, 3);
    assert_int_equal(blocking_integrate(&def, times, 3, f, NULL, NULL), BLOCKING_OK);
    double a = blocking_free_fraction(1.0, .01, .0075, 10.0), b = blocking_free_fraction(a, .01, .0175, 20.0);
    near(f[0], a, 1e-15);
    near(f[1], b, 1e-15);
    near(f[2], blocking_free_fraction(b, .004, .0175, 10.0), 1e-15);

    /* straight lines: over 0..10 s, k1 = 0.01, k2 = 0.0075 + 0.001 t; e^(-X) integrated by Simpson's rule */
    s.stepwise = 0;
    assert_int_equal(blocking_integrate(&def, times, 3, f, NULL, NULL), BLOCKING_OK);
    double sum = 0.0;
    const int n = 2000;
    for (int i = 0; i <= n; i++) {
        double t = 10.0 * i / n, X = .0175 * t + .0005 * t * t;
        sum += (i == 0 || i == n ? 1 : i % 2 ? 4 : 2) * (.0075 + .001 * t) * exp(X) * 10.0 / n / 3.0;
    }
    near(f[0], exp(-.0175 * 10 - .05) * (1.0 + sum), 1e-10);

    double bad[3];
    memcpy(bad, x_h, sizeof bad);
    bad[1] = 50.0;
    s.x_h = bad;
    assert_int_equal(blocking_check_schedule(&s, &row), BLOCKING_IN_PERCENT);
    assert_int_equal(row, 1);
    bad[1] = -0.5;
    assert_int_equal(blocking_check_schedule(&s, NULL), BLOCKING_NEGATIVE);
    bad[1] = nan_;
    assert_int_equal(blocking_check_schedule(&s, NULL), BLOCKING_NOT_FINITE);
    s.x_h = x_h;
    const double back[] = {0.0, 10.0, 10.0};
    s.time = back;
    assert_int_equal(blocking_check_schedule(&s, &row), BLOCKING_NOT_RISING);
    assert_int_equal(row, 2);
    s.time = time;
    s.n = 0;
    assert_int_equal(blocking_check_schedule(&s, &row), BLOCKING_TOO_FEW);
    s.n = 3;
    s.K = NULL;
    assert_int_equal(blocking_check_schedule(&s, &row), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_check_schedule(NULL, NULL), BLOCKING_BAD_ARGUMENT);
}

static void bad_integrations(void **state) {
    (void)state;
    changing l = {0, 0.0};
    blocking_ode_def good = blocking_default_ode_def(), def;
    good.rates = rates;
    good.user = &l;
    const char *field = "";
    assert_int_equal(blocking_check_ode_def(&good, &field), BLOCKING_OK);
    assert_null(field);
    const double falling[] = {1.0, 0.5};
#define BAD(change, name)                                                                                              \
    def = good;                                                                                                        \
    change;                                                                                                            \
    assert_int_equal(blocking_check_ode_def(&def, &field), BLOCKING_BAD_DEF);                                          \
    assert_string_equal(field, name)
    BAD(def.cookie = 0, "cookie");
    BAD(def.f0 = nan_, "f0");
    BAD(def.f0 = 95.0, "f0");
    BAD(def.start = HUGE_VAL, "start");
    BAD(def.rates = NULL, "rates");
    BAD(def.n_breaks = 2, "breaks");
    BAD((def.n_breaks = 2, def.breaks = falling), "breaks");
    BAD(def.tolerance = 0.0, "tolerance");
    BAD(def.max_step = nan_, "max_step");
    BAD(def.max_steps = 0, "max_steps");
    assert_int_equal(blocking_check_ode_def(NULL, NULL), BLOCKING_BAD_DEF);
    assert_int_equal(blocking_check_ode_def(NULL, &field), BLOCKING_BAD_DEF);
    assert_string_equal(field, "def");

    const double times[] = {1.0, 2.0, 3.0}, same[] = {1.0, 1.0}, unknown[] = {1.0, nan_}, before[] = {-1.0, 1.0};
    double f[3];
    blocking_ode_report report;
    assert_int_equal(blocking_integrate(&good, same, 2, f, NULL, NULL), BLOCKING_NOT_RISING);
    assert_int_equal(blocking_integrate(&good, before, 2, f, NULL, NULL), BLOCKING_NOT_RISING);
    assert_int_equal(blocking_integrate(&good, unknown, 2, f, NULL, NULL), BLOCKING_NOT_FINITE);
    assert_int_equal(blocking_integrate(&good, times, 0, f, NULL, NULL), BLOCKING_TOO_FEW);
    assert_int_equal(blocking_integrate(&good, NULL, 3, f, NULL, NULL), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_integrate(NULL, times, 3, f, NULL, NULL), BLOCKING_BAD_DEF);
    assert_true(isnan(f[0]));
    for (l.kind = 3; l.kind <= 4; l.kind++) {
        assert_int_equal(blocking_integrate(&good, times, 3, f, NULL, &report), BLOCKING_BAD_RATE);
        assert_true(isnan(f[0]) && report.time == 0.0);
    }
    l.kind = 1;
    def = good;
    def.tolerance = 1e-4;
    def.max_steps = 15;
    def.max_step = 0.1;
    assert_int_equal(blocking_integrate(&def, times, 3, f, NULL, &report), BLOCKING_TOO_MANY_STEPS);
    assert_true(f[0] > 0.0 && isnan(f[1]) && isnan(f[2]) && report.time >= 1.0 && report.time < 2.0);
}

/* ---- three readings ---- */

static blocking_status three(double t0, double t1, double t2, double f0, double f1, double f2, blocking_estimate *e) {
    const double t[3] = {t0, t1, t2}, f[3] = {f0, f1, f2};
    return blocking_three_point(t, f, 0.0, BLOCKING_TOLERANCE, e);
}

static void three_points(void **state) {
    (void)state;
    blocking_estimate e;
    const double k = .0101, f_inf = .714, start = .949;
#define AT(t) blocking_curve(start, f_inf, k, t)
    assert_int_equal(three(0, 10, 30, AT(0), AT(10), AT(30), &e), BLOCKING_OK); /* section 5: rho = 3 */
    near((AT(30) - AT(0)) / (AT(10) - AT(0)), 2.7210279608281, 1e-12);
    near(e.r, 0.903933032885864, 1e-13);
    near(e.k, k, 1e-14);
    near(e.f_inf, f_inf, 1e-12);
    near(e.f0, start, 0.0);
    near(e.k1, k * (1 - f_inf), 1e-13);
    near(e.k2, k * f_inf, 1e-13);
    /* eq 14 as printed, on readings it is not made for, against its numbers in the specification: what three_point is
       there to avoid */
    double wrong = (AT(0) * AT(30) - AT(10) * AT(10)) / (AT(0) - 2 * AT(10) + AT(30));
    near(wrong, 0.980310487939876, 1e-12);
    wrong = (AT(64) * AT(256) - AT(128) * AT(128)) / (AT(64) - 2 * AT(128) + AT(256));
    near(wrong, 0.546329247650, 1e-12);
    assert_int_equal(three(64, 128, 256, AT(64), AT(128), AT(256), &e), BLOCKING_OK);
    near(e.f_inf, f_inf, 1e-13);
    near(e.f0, start, 1e-13);
    assert_int_equal(three(0, 5, 10, AT(0), AT(5), AT(10), &e), BLOCKING_OK);
    near(e.f_inf, f_inf, 1e-11);
    /* Every neighbouring pair of the schedule qualifies with t = 0; the first ones amplify. */
    for (int t = 1; t <= 1024; t *= 2) {
        assert_int_equal(three(0, t, 2 * t, AT(0), AT(t), AT(2 * t), &e), BLOCKING_OK);
        near(e.f_inf, f_inf, 1e-15 * blocking_noise_f_inf(exp(-k * t)) + 1e-15);
        close_to(e.k, k, 1e-15 * blocking_noise_k(exp(-k * t)) / .235 + 1e-15);
    }
#undef AT
    uint64_t seed = 3; /* any times, rising and falling curves, against the parameters */
    int solved = 0;
    for (int i = 0; i < 100000; i++) {
        double f0 = random_plain(&seed), fi = random_plain(&seed), kk = exp(12 * random_plain(&seed) - 8),
               ta = i % 3 ? random_plain(&seed) / kk : 0.0;
        double h = 3 * random_plain(&seed) / kk + 1e-3 / kk, rho = 1.05 + 8 * random_plain(&seed);
        if (i % 5 == 0) rho = 2;
        if (i % 5 == 1) rho = 3;
        double t[3] = {ta, ta + h, ta + rho * h}, f[3], noise = 4e-16;
        for (int j = 0; j < 3; j++) f[j] = blocking_curve(f0, fi, kk, t[j]);
        blocking_status status = blocking_three_point(t, f, noise, 1e-13, &e);
        if (isnan(e.k) || !(e.error_k / kk < 1e-6)) continue; /* readings too alike */
        solved++;
        assert_true(status == BLOCKING_OK || status == BLOCKING_OUT_OF_RANGE);
        if (fabs(e.k - kk) > 4 * e.error_k + 1e-13 * kk || fabs(e.f_inf - fi) > 4 * e.error_f_inf + 1e-13 ||
            fabs(e.f0 - f0) > 4 * e.error_f0 + 1e-13)
            fail_msg("f0 %g f_inf %g k %g, times %g %g %g: k off by %g, f_inf by %g", f0, fi, kk, t[0], t[1], t[2],
                     e.k / kk - 1, e.f_inf - fi);
    }
    assert_true(solved > 90000);
}

static void three_point_statuses(void **state) {
    (void)state;
    blocking_estimate e;
    assert_int_equal(three(0, 1, 2, 0.8, 0.8, 0.8, &e), BLOCKING_NO_CHANGE);
    assert_true(e.f_inf == 0.8 && e.f0 == 0.8 && isnan(e.k));
    assert_int_equal(three(0, 1, 2, 0.9, 0.7, 0.8, &e), BLOCKING_NON_MONOTONE); /* eq 15 would give a k here */
    assert_true(isnan(e.f_inf) && isnan(e.k));
    assert_int_equal(three(0, 1, 2, 0.9, 0.7, 0.7, &e), BLOCKING_NON_MONOTONE);
    assert_int_equal(three(0, 1, 2, 0.9, 0.8, 0.7, &e), BLOCKING_NOT_SATURATING);
    assert_int_equal(three(0, 1, 2, 0.9, 0.8, 0.6, &e), BLOCKING_NOT_SATURATING);
    assert_int_equal(three(0, 1, 3, 0.9, 0.8, 0.6, &e), BLOCKING_NOT_SATURATING);
    assert_int_equal(three(0, 2, 5, 0.5, 0.6, 0.75, &e), BLOCKING_NOT_SATURATING); /* straight, rho = 2.5 */
    assert_true(isnan(e.f_inf) && isnan(e.k));
    assert_int_equal(three(0, 1, 2, 0.3, 0.2, 0.11, &e), BLOCKING_OUT_OF_RANGE);
    near(e.r, 0.9, 1e-14);
    near(e.f_inf, -0.7, 1e-12);
    near(e.f_inf_clipped, 0.0, 0.0);
    near(e.k1, e.k, 1e-15);
    assert_int_equal(three(0, 1, 2, 0.7, 0.8, 0.89, &e), BLOCKING_OUT_OF_RANGE);
    near(e.f_inf_clipped, 1.0, 0.0);
    /* at t = 0 it would be far above 1 */
    assert_int_equal(three(10, 11, 12, 0.9, 0.5, 0.3, &e), BLOCKING_OUT_OF_RANGE);
    assert_true(e.f0 > 1.0 && e.f_inf > 0.0);
    assert_int_equal(three(0, 1, 2, 95, 70, 60, &e), BLOCKING_IN_PERCENT);
    assert_int_equal(three(0, 1, 2, -0.1, 0.2, 0.3, &e), BLOCKING_NEGATIVE);
    assert_int_equal(three(0, 1, 2, nan_, 0.2, 0.3, &e), BLOCKING_NOT_FINITE);
    assert_int_equal(three(0, nan_, 2, 0.1, 0.2, 0.3, &e), BLOCKING_NOT_FINITE);
    assert_int_equal(three(0, 2, 2, 0.1, 0.2, 0.3, &e), BLOCKING_NOT_RISING);
    assert_int_equal(three(2, 1, 3, 0.1, 0.2, 0.3, &e), BLOCKING_NOT_RISING);
    assert_int_equal(three(-1, 1, 3, 0.1, 0.2, 0.3, &e), BLOCKING_NOT_RISING);
    assert_int_equal(blocking_three_point(NULL, NULL, 0, 0, &e), BLOCKING_BAD_ARGUMENT);
    const double t[] = {0, 1, 2}, f[] = {.9, .8, .75};
    assert_int_equal(blocking_three_point(t, f, nan_, 0, &e), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_three_point(t, f, 0, 0, NULL), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(three(0, 1e-300, 2e-300, 0.9, 0.8, 0.75, &e), BLOCKING_OK);
    close_to(e.k, log(2.0) / 1e-300, 1e-14);
}

static void noise(void **state) {
    (void)state;
    const double r[] = {.1, .3, .5, .7, .9}, wanted[] = {1.26, 2.39, 5.74, 19.9, 221.};
    for (int i = 0; i < 5; i++) near(blocking_noise_f_inf(r[i]), wanted[i], 5e-3);
    near(blocking_noise_f_inf(.5), 5.74456264653803, 1e-14);
    /* the least is 6.114574586614678, not the 6.114574708 of the specification */
    const double best = 0.203841191738773933;
    near(blocking_noise_k(best), 6.11457458661467759, 1e-14);
    assert_true(blocking_noise_k(best * 1.001) > blocking_noise_k(best) &&
                blocking_noise_k(best * 0.999) > blocking_noise_k(best));
    near(exp(-BLOCKING_BEST_KT), best, 1e-15);
    assert_true(isnan(blocking_noise_k(0.0)) && isnan(blocking_noise_k(1.0)) && isnan(blocking_noise_f_inf(nan_)) &&
                isnan(blocking_noise_f_inf(-1.0)));
    /* fit 7a with 400 holes: k is not resolved, s_k/k > 2.8 at best */
    assert_true(0.0098 * blocking_noise_k(best) / .0209 > 2.8);

    /* 40-digit Jacobians of the general case: standard errors over sigma of f_inf, k, f0 */
    const struct {
        double t0, h, rho, k, A, f_inf, k_, f0;
    } cases[] = {{0, 10, 3, .0101, .235, 116.99161765186696, 5.883664609576097, 1.0},
                 {4, 8, 2.5, .03, -.3, 27.491115441385781, 3.7056277732566208, 2.3584007165465413},
                 {0, 10, 2, .05, .2, 10.428851435177168, 4.1633222552955537, 1.0}};
    for (size_t i = 0; i < LENGTH(cases); i++) {
        double t[3] = {cases[i].t0, cases[i].t0 + cases[i].h, cases[i].t0 + cases[i].rho * cases[i].h}, f[3];
        for (int j = 0; j < 3; j++) f[j] = 0.7 + cases[i].A * exp(-cases[i].k * (t[j] - t[0]));
        blocking_estimate e;
        assert_int_equal(blocking_three_point(t, f, 1.0, 0.0, &e), BLOCKING_OK);
        close_to(e.error_f_inf, cases[i].f_inf, 1e-10);
        close_to(e.error_k, cases[i].k_, 1e-10);
        close_to(e.error_f0, cases[i].f0, 1e-10);
    }
    /* the two laws are its case rho = 2 */
    const double t[3] = {0, 2, 4}, f[3] = {0.9, 0.7 + 0.2 * 0.3, 0.7 + 0.2 * 0.09};
    blocking_estimate e;
    assert_int_equal(blocking_three_point(t, f, 1e-3, 0.0, &e), BLOCKING_OK);
    close_to(e.error_f_inf, 1e-3 * blocking_noise_f_inf(0.3), 1e-13);
    close_to(e.error_k / e.k, 1e-3 * blocking_noise_k(0.3) / 0.2, 1e-13);
}

/* ---- least squares ---- */

static void fits_recover_exact_data(void **state) {
    (void)state;
    const double schedule[] = {0, 1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048}, industrial[] = {0, 5, 10, 30};
    blocking_fit_def def = blocking_default_fit_def();
    blocking_fit_result fit;
    double f[13];
    for (size_t i = 0; i < LENGTH(table2); i++)
        for (int s = 0; s < 2; s++) {
            const double *t = s ? industrial : schedule;
            size_t n = s ? LENGTH(industrial) : LENGTH(schedule);
            for (size_t j = 0; j < n; j++) f[j] = blocking_curve(table2[i].start, table2[i].f_inf, table2[i].k, t[j]);
            assert_int_equal(blocking_fit(&def, t, f, NULL, n, &fit), BLOCKING_OK);
            /* the four industrial readings hold f_inf to a few 100 times their own rounding */
            near(fit.f_inf, table2[i].f_inf, s ? 1e-12 : 1e-14);
            near(fit.f0, table2[i].start, 1e-14);
            close_to(fit.k, table2[i].k, s ? 1e-11 : 1e-13);
            near(fit.r2, 1.0, 1e-13);
            assert_true(fit.sse < 1e-28 && fit.k_lowest <= fit.k && fit.k_highest >= fit.k &&
                        fit.k_highest < (1 + 1e-10) * fit.k_lowest);
            near(fit.k1, fit.k * (1 - fit.f_inf), 1e-16);
            near(fit.k2, fit.k * fit.f_inf, 1e-16);
            assert_false(fit.f0_on_bound || fit.f_inf_on_bound);
        }
    /* three readings: the estimator's answer, and no error without sigma */
    const double t[] = {2, 10, 30}, g[] = {.9, .8, .7};
    blocking_estimate e;
    assert_int_equal(blocking_three_point(t, g, 0.01, 1e-9, &e), BLOCKING_OK);
    assert_int_equal(blocking_fit(&def, t, g, NULL, 3, &fit), BLOCKING_OK);
    near(fit.f_inf, e.f_inf, 1e-13);
    near(fit.f0, e.f0, 1e-13);
    near(fit.k, e.k, 1e-14);
    assert_true(isnan(fit.error_k) && isnan(fit.k_lowest));
    const double sigma[] = {.01, .01, .01};
    assert_int_equal(blocking_fit(&def, t, g, sigma, 3, &fit), BLOCKING_OK); /* linearised errors agree too */
    close_to(fit.error_f_inf, e.error_f_inf, 1e-8);
    close_to(fit.error_f0, e.error_f0, 1e-8);
    close_to(fit.error_k, e.error_k, 1e-8);
    assert_true(fit.k_lowest < fit.k && fit.k_highest > fit.k);
    /* pure blocking and pure unblocking end on a bound, and are still determined */
    for (int up = 0; up < 2; up++) {
        for (int j = 0; j < 13; j++)
            f[j] = up ? blocking_pure_unblocking(.3, .02, schedule[j]) : blocking_pure_blocking(.9, .02, schedule[j]);
        assert_int_equal(blocking_fit(&def, schedule, f, NULL, 13, &fit), BLOCKING_OK);
        near(fit.f_inf, up, 1e-14);
        close_to(fit.k, .02, 1e-13);
    }
}

static void fit_statuses(void **state) {
    (void)state;
    blocking_fit_def def = blocking_default_fit_def();
    blocking_fit_result fit;
    const double t[] = {0, 10, 20, 30, 40};
#define FIT(a, b, c, d, e)                                                                                             \
    f[0] = a, f[1] = b, f[2] = c, f[3] = d, f[4] = e, status = blocking_fit(&def, t, f, NULL, 5, &fit)
    double f[5];
    blocking_status status;
    FIT(.8, .8, .8, .8, .8);
    assert_int_equal(status, BLOCKING_NO_CHANGE);
    assert_true(fit.f_inf == .8 && fit.f0 == .8 && isnan(fit.k) && isnan(fit.r2));
    FIT(.9, .5, .9, .5, .9);
    assert_int_equal(status, BLOCKING_NON_MONOTONE);
    FIT(.9, .6, .5, .6, .9);
    assert_int_equal(status, BLOCKING_NON_MONOTONE);
    FIT(.9, .8, .7, .6, .5); /* straight: the bound holds f_inf, not the data */
    assert_int_equal(status, BLOCKING_NOT_SATURATING);
    FIT(.1, .15, .25, .45, .85);
    assert_int_equal(status, BLOCKING_NOT_SATURATING);
    FIT(.9, .6, .6, .6, .6);
    assert_int_equal(status, BLOCKING_NOT_RESOLVED);
    near(fit.f0, .9, 1e-12);
    near(fit.f_inf, .6, 1e-12);
    assert_true(isinf(fit.k_highest) || fit.k_highest > 1.0);
    FIT(.95, .80, .84, .75, .76); /* noisy, but an exponential */
    assert_int_equal(status, BLOCKING_OK);
    assert_true(fit.r2 > 0.8 && fit.r2 < 1.0 && fit.error_k > 0.0 && fit.k_lowest < fit.k && fit.k_highest > fit.k);
    FIT(90, 80, 75, 72, 71);
    assert_int_equal(status, BLOCKING_IN_PERCENT);
    assert_true(isnan(fit.k));
    FIT(.9, .8, nan_, .7, .7);
    assert_int_equal(status, BLOCKING_NOT_FINITE);
    FIT(.9, .8, -.1, .7, .7);
    assert_int_equal(status, BLOCKING_NEGATIVE);
    FIT(.9, .8, .75, .72, .71);
    assert_int_equal(status, BLOCKING_OK);
    const double back[] = {0, 10, 10, 30, 40}, minus[] = {-1, 10, 20, 30, 40}, unknown[] = {0, 10, nan_, 30, 40},
                 never[] = {0, 10, 20, 30, HUGE_VAL};
    assert_int_equal(blocking_fit(&def, back, f, NULL, 5, &fit), BLOCKING_NOT_RISING);
    assert_int_equal(blocking_fit(&def, minus, f, NULL, 5, &fit), BLOCKING_NOT_RISING);
    assert_int_equal(blocking_fit(&def, unknown, f, NULL, 5, &fit), BLOCKING_NOT_FINITE);
    assert_int_equal(blocking_fit(&def, never, f, NULL, 5, &fit), BLOCKING_NOT_FINITE);
    for (size_t n = 0; n < 3; n++) assert_int_equal(blocking_fit(&def, t, f, NULL, n, &fit), BLOCKING_TOO_FEW);
    assert_int_equal(blocking_fit(&def, NULL, f, NULL, 5, &fit), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_fit(&def, t, f, NULL, 5, NULL), BLOCKING_BAD_ARGUMENT);
    double sigma[] = {.01, .01, 0, .01, .01};
    assert_int_equal(blocking_fit(&def, t, f, sigma, 5, &fit), BLOCKING_BAD_ARGUMENT);
    sigma[2] = -.01;
    assert_int_equal(blocking_fit(&def, t, f, sigma, 5, &fit), BLOCKING_NEGATIVE);
    sigma[2] = nan_;
    assert_int_equal(blocking_fit(&def, t, f, sigma, 5, &fit), BLOCKING_NOT_FINITE);
    const char *field;
    blocking_fit_def good = def;
#define BAD_FIT(change, name)                                                                                          \
    def = good;                                                                                                        \
    change;                                                                                                            \
    assert_int_equal(blocking_check_fit_def(&def, &field), BLOCKING_BAD_DEF);                                          \
    assert_string_equal(field, name);                                                                                  \
    assert_int_equal(blocking_fit(&def, t, f, NULL, 5, &fit), BLOCKING_BAD_DEF)
    BAD_FIT(def.cookie = 1, "cookie");
    BAD_FIT(def.k_low = 0.0, "k_low");
    BAD_FIT(def.k_high = nan_, "k_high");
    BAD_FIT(def.z = -1.0, "z");
    BAD_FIT(def.turn_back = 0.0, "turn_back");
    BAD_FIT(def.tolerance = nan_, "tolerance");
    assert_int_equal(blocking_check_fit_def(NULL, &field), BLOCKING_BAD_DEF);
    assert_string_equal(field, "def");
    assert_int_equal(blocking_check_fit_def(&good, &field), BLOCKING_OK);
    assert_null(field);
    assert_int_equal(blocking_fit(NULL, t, f, NULL, 5, &fit), BLOCKING_BAD_DEF);
    const double tiny[] = {0, 1e-300, 2e-300, 3e-300, 4e-300}; /* beyond k_high: said, not guessed */
    assert_int_equal(blocking_fit(&good, tiny, f, NULL, 5, &fit), BLOCKING_BAD_DEF);
}

/* A normal deviate (sum of twelve uniforms) */
static double deviate(uint64_t *seed) {
    double sum = -6.0;
    for (int i = 0; i < 12; i++) sum += random_plain(seed);
    return sum;
}

static void fit_intervals_cover(void **state) {
    (void)state;
    /* fit 7b, the paper's schedule, noise of 400 counted holes: k within its 95 % profile range in about 95 of 100
       trials, and its scatter as predicted */
    const double t[] = {0, 1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048}, k = .0101;
    blocking_fit_def def = blocking_default_fit_def();
    blocking_fit_result fit;
    uint64_t seed = 11;
    int inside = 0, trials = 1000;
    double spread = 0.0, predicted = 0.0;
    for (int i = 0; i < trials; i++) {
        double f[13], sigma[13];
        for (int j = 0; j < 13; j++) {
            double exact = blocking_curve(.949, .714, k, t[j]);
            sigma[j] = sqrt(exact * (1 - exact) / 400.0);
            f[j] = fmin(1.0, exact + sigma[j] * deviate(&seed));
        }
        blocking_status status = blocking_fit(&def, t, f, sigma, 13, &fit);
        assert_int_equal(status, BLOCKING_OK);
        inside += fit.k_lowest <= k && k <= fit.k_highest;
        spread += (fit.k - k) * (fit.k - k) / trials;
        predicted += fit.error_k * fit.error_k / trials;
    }
    assert_in_range(inside, 930, 970);
    close_to(sqrt(predicted), sqrt(spread), 0.15);

    /* fit 7a: an amplitude of 0.021 under the same noise; the range says that k is open */
    int open = 0;
    for (int i = 0; i < 200; i++) {
        double f[13], sigma[13];
        for (int j = 0; j < 13; j++) {
            double exact = blocking_curve(.9809, .960, .0421, t[j]);
            sigma[j] = sqrt(exact * (1 - exact) / 400.0);
            f[j] = fmin(1.0, exact + sigma[j] * deviate(&seed));
        }
        blocking_fit(&def, t, f, sigma, 13, &fit);
        open += fit.k_lowest == 0.0 || isinf(fit.k_highest) || fit.k_highest > 10 * fit.k_lowest;
    }
    assert_true(open > 150);
}

/* Student's t against tables (two sides, 95 % and 99 %) */
static void student(void **state) {
    (void)state;
    const struct {
        double z, dof, t;
    } table[] = {{1.959963984540054, 1, 12.7062047361747},   {1.959963984540054, 2, 4.30265272974946},
                 {1.959963984540054, 3, 3.18244630528371},   {1.959963984540054, 10, 2.22813885198627},
                 {1.959963984540054, 120, 1.97993040505278}, {1.959963984540054, 1000, 1.9623390808},
                 {2.575829303548901, 1, 63.6567411628716},   {2.575829303548901, 5, 4.03214298355522},
                 {2.575829303548901, 200, 2.600634434}};
    for (size_t i = 0; i < LENGTH(table); i++) close_to(blocking_student(table[i].z, table[i].dof), table[i].t, 3e-9);
    assert_true(blocking_student(2.0, HUGE_VAL) == 2.0 && blocking_student(2.0, 2e6) == 2.0);
    close_to(blocking_student(2.0, 200.0), blocking_student(2.0, 200.001), 1e-7);
    assert_true(isnan(blocking_student(0.0, 5)) && isnan(blocking_student(nan_, 5)) &&
                isnan(blocking_student(2, 0.5)) && isnan(blocking_student(2, nan_)) &&
                blocking_student(HUGE_VAL, 2) > 1e4);
}

/* 13, 6, 5 and 4 readings, with and without sigma: the ranges of k and of f_inf hold the truth in 95 of 100 trials. The
   same with 2000 trials: scripts/verify blocking_coverage. */
static void ranges_cover(void **state) {
    (void)state;
    const double t[4][13] = {{0, 1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048},
                             {0, 20, 50, 100, 200, 400},
                             {0, 5, 10, 30, 60},
                             {0, 5, 10, 30}};
    const int count[4] = {13, 6, 5, 4};
    const char *setting = getenv("RIDDLE_TRIALS");
    const int trials = setting ? atoi(setting) : 300;
    const double margin = setting ? 0.02 : 0.04; /* 300 trials scatter by 0.0126 */
    uint64_t seed = 3;
    for (int s = 0; s < 8; s++) {
        const int n = count[s / 2];
        int k = 0, f_inf = 0, open = 0;
        for (int i = 0; i < trials; i++) {
            double f[13], sigma[13];
            for (int j = 0; j < n; j++)
                f[j] = blocking_curve(.949, .714, .0101, t[s / 2][j]) + (sigma[j] = 0.01) * deviate(&seed);
            blocking_fit_def def = blocking_default_fit_def();
            blocking_fit_result fit;
            blocking_status status = blocking_fit(&def, t[s / 2], f, s % 2 ? sigma : NULL, (size_t)n, &fit);
            assert_true(status <= BLOCKING_NOT_RESOLVED);
            k += fit.k_lowest <= .0101 && .0101 <= fit.k_highest;
            f_inf += fit.f_inf_lowest <= .714 && .714 <= fit.f_inf_highest;
            open += !fit.k_determined || !fit.f_inf_determined;
        }
        if (setting)
            print_message("%2d readings%s: k in %.3f, f_inf in %.3f of the ranges, one left open in %.2f\n", n,
                          s % 2 ? ", sigma" : "", (double)k / trials, (double)f_inf / trials, (double)open / trials);
        assert_true(fabs(k - 0.95 * trials) <= margin * trials && fabs(f_inf - 0.95 * trials) <= margin * trials);
    }
}

/* Counts near 1: the range of f0 holds where errors of the single readings, zero for a clean sieve, do not (thousands:
   scripts/verify blocking_counts). */
static void fits_of_counted_holes(void **state) {
    (void)state;
    enum { N = 6, TRIALS = 400 };
    const blocking_fit_def def = blocking_default_fit_def();
    const double t[N] = {0, 10, 25, 50, 90, 160};
    const size_t more[3] = {3, 11, 4}, ten[3] = {10, 10, 10}, none[3] = {0, 0, 0}, rising[3] = {1, 5, 9};
    blocking_fit_result fit;
    double f[N], sigma[N];
    int held[2] = {0, 0};
    uint64_t seed = 5;
    for (int i = 0; i < TRIALS; i++) {
        size_t free_holes[N], holes[N];
        for (int j = 0; j < N; j++) {
            const double p = blocking_curve(0.985, 0.8, 0.02, t[j]);
            free_holes[j] = 0, holes[j] = 200;
            for (int k = 0; k < 200; k++) free_holes[j] += random_plain(&seed) < p;
        }
        assert_true(blocking_fit_holes(&def, t, free_holes, holes, N, f, sigma, &fit) <= BLOCKING_NOT_RESOLVED);
        held[0] += fit.f0_lowest <= 0.985 && 0.985 <= fit.f0_highest,
            held[1] += fit.f_inf_lowest <= 0.8 && 0.8 <= fit.f_inf_highest;
        for (int j = 0; j < N; j++)
            assert_true(f[j] == (double)free_holes[j] / 200.0 && sigma[j] > 0.0 && sigma[j] < 0.05);
    }
    print_message("counted holes: ranges of f0, f_inf hold %d, %d of %d\n", held[0], held[1], TRIALS);
    for (int k = 0; k < 2; k++) assert_true(held[k] >= 0.92 * TRIALS && held[k] <= 0.985 * TRIALS);
    /* clean throughout: no change, with a range; what is refused */
    assert_int_equal(blocking_fit_holes(&def, t, ten, ten, 3, f, sigma, &fit), BLOCKING_NO_CHANGE);
    assert_true(fit.f_inf == 1.0 && fit.f_inf_lowest < 0.95 && fit.f_inf_highest == 1.0);
    assert_int_equal(blocking_fit_holes(&def, t, more, ten, 3, f, sigma, &fit), BLOCKING_BAD_COUNT);
    assert_int_equal(blocking_fit_holes(&def, t, none, none, 3, f, sigma, &fit), BLOCKING_BAD_COUNT);
    assert_int_equal(blocking_fit_holes(&def, t, ten, ten, 2, f, sigma, &fit), BLOCKING_TOO_FEW);
    assert_int_equal(blocking_fit_holes(&def, t, ten, ten, 0, f, sigma, &fit), BLOCKING_TOO_FEW);
    assert_int_equal(blocking_fit_holes(NULL, t, ten, ten, 3, f, sigma, &fit), BLOCKING_BAD_DEF);
    assert_int_equal(blocking_fit_holes(&def, t, NULL, ten, 3, f, sigma, &fit), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_fit_holes(&def, t, ten, ten, 3, f, sigma, NULL), BLOCKING_BAD_ARGUMENT);
    assert_true(blocking_fit_holes(&def, t, rising, ten, 3, f, sigma, &fit) <= BLOCKING_NOT_RESOLVED);
}

static void what_four_readings_say(void **state) {
    (void)state;
    /* the header's example: drawn from f_inf = 0.714 */
    const double t[] = {0, 5, 10, 30}, f[] = {0.949, 0.937, 0.926, 0.888}, sigma[] = {.011, .012, .013, .016};
    blocking_fit_def def = blocking_default_fit_def();
    blocking_fit_result fit, counted;
    assert_int_equal(blocking_fit(&def, t, f, NULL, 4, &fit), BLOCKING_OK);
    assert_true(fit.dof == 1.0 && fit.f_inf_lowest < .714 && fit.f_inf_highest > .8);
    close_to(fit.student, 12.71, 1e-2);
    assert_int_equal(blocking_fit(&def, t, f, sigma, 4, &counted), BLOCKING_OK);
    assert_true(isinf(counted.dof) && !counted.k_determined && !counted.f_inf_determined &&
                counted.f_inf_lowest == 0.0);
    /* on a bound there is a range and no error */
    double g[6];
    const double u[] = {0, 10, 20, 40, 80, 160};
    for (int i = 0; i < 6; i++) g[i] = fmax(0.0, blocking_pure_blocking(.9, .02, u[i]) - (i % 2 ? .004 : 0.0));
    blocking_fit(&def, u, g, NULL, 6, &fit);
    assert_true(fit.f_inf_on_bound && isnan(fit.error_f_inf) && fit.f_inf_lowest == 0.0 && fit.f_inf_highest > 0.0 &&
                fit.error_k > 0.0);
    /* of the curve at a time and of its mean: at 0 that of f0, at infinity that of f_inf; between, narrower than where
       nothing was read */
    double low[4], high[4], mean_low, mean_high;
    const double when[4] = {0.0, 30.0, 600.0, HUGE_VAL};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(blocking_fit_range(&def, t, f, sigma, 4, when[i], &low[i], &high[i], &mean_low, &mean_high),
                         BLOCKING_OK);
        assert_true(low[i] <= high[i] && mean_low <= mean_high);
    }
    assert_true(low[0] == counted.f0_lowest && high[0] == counted.f0_highest && low[3] == counted.f_inf_lowest &&
                high[3] == counted.f_inf_highest);
    assert_true(high[1] - low[1] < high[2] - low[2]);
    assert_int_equal(blocking_fit_range(&def, t, f, NULL, 3, 1.0, &low[0], NULL, NULL, NULL), BLOCKING_TOO_FEW);
    assert_true(isnan(low[0]));
    assert_int_equal(blocking_fit_range(&def, t, f, NULL, 4, nan_, &low[0], NULL, NULL, NULL), BLOCKING_BAD_ARGUMENT);
    /* through to the deck */
    blocking_duty duty = blocking_default_duty();
    blocking_deck deck;
    duty.passing = 1.0, duty.capacity = 2.0, duty.clearance = 0.5, duty.f0 = counted.f0, duty.f_inf = counted.f_inf,
    duty.k = counted.k;
    duty.run_time = 60.0;
    assert_int_equal(blocking_design(&duty, &deck), BLOCKING_OK);
    assert_true(isnan(deck.area_mean_low95) && isnan(deck.area_lowest_high95));
    blocking_fit_range(&def, t, f, sigma, 4, 60.0, &duty.last_lowest, &duty.last_highest, &duty.mean_lowest,
                       &duty.mean_highest);
    assert_int_equal(blocking_design(&duty, &deck), BLOCKING_OK);
    assert_true(deck.area_mean_low95 < deck.area_mean && deck.area_mean < deck.area_mean_high95);
    close_to(deck.area_mean_high95, deck.area_clean / duty.mean_lowest, 1e-15);
    duty.mean_lowest = 2.0;
    assert_int_equal(blocking_design(&duty, &deck), BLOCKING_BAD_DEF);
}

/* Equal readings are as certain as their sigma, no more: as those that differ by next to nothing. */
static void equal_readings_with_sigma(void **state) {
    (void)state;
    const double t[] = {0, 10, 20, 40, 80};
    blocking_fit_def def = blocking_default_fit_def();
    blocking_fit_result fit;
    double low[2], high[2], mean_low[2], mean_high[2];
    for (double s = 1e-2; s > 1e-9; s *= 1e-2) {
        const double sigma[] = {s, s, s, s, s}, when[] = {0, 25, 80, HUGE_VAL};
        for (size_t i = 0; i < LENGTH(when); i++) {
            for (int differ = 0; differ < 2; differ++) {
                const double f[] = {.96, .96, .96 + (differ ? 1e-6 * s : 0.0), .96, .96};
                if (differ) def.tolerance = 0.0;
                assert_int_equal(blocking_fit_range(&def, t, f, sigma, 5, when[i], &low[differ], &high[differ],
                                                    &mean_low[differ], &mean_high[differ]),
                                 BLOCKING_OK);
            }
            def = blocking_default_fit_def();
            near(low[0], low[1], 1e-5 * s);
            near(high[0], high[1], 1e-5 * s);
            near(mean_low[0], mean_low[1], 1e-5 * s);
            near(mean_high[0], mean_high[1], 1e-5 * s);
            const double half = fmin(.96 - low[0], high[0] - .96);
            if (isinf(when[i])) assert_true(low[0] == 0.0 && high[0] == 1.0); /* slow enough, it ends anywhere */
            else assert_true(half > 1.96 * s / sqrt(5.0) - 1e-12 && half < 3.0 * s);
        }
        const double same[] = {.96, .96, .96, .96, .96};
        assert_int_equal(blocking_fit(&def, t, same, sigma, 5, &fit), BLOCKING_NO_CHANGE);
        blocking_fit_range(&def, t, same, sigma, 5, 0.0, &low[0], &high[0], NULL, NULL);
        assert_true(fit.f_inf == .96 && isnan(fit.k) && isnan(fit.error_f_inf) && isinf(fit.dof) &&
                    fit.student == 1.96);
        assert_true(fit.f0_lowest == low[0] && fit.f0_highest == high[0] && fit.f_inf_lowest == 0.0 &&
                    fit.f_inf_highest == 1.0);
        assert_true(fit.k_lowest == 0.0 && isinf(fit.k_highest) && !fit.k_determined && !fit.f_inf_determined);
        /* without sigma nothing tells the spread */
        assert_int_equal(blocking_fit_range(&def, t, same, NULL, 5, 1.0, low, high, mean_low, mean_high),
                         BLOCKING_NO_CHANGE);
        assert_true(isnan(low[0]) && isnan(high[0]) && isnan(mean_low[0]) && isnan(mean_high[0]));
        assert_int_equal(blocking_fit(&def, t, same, NULL, 5, &fit), BLOCKING_NO_CHANGE);
        assert_true(isnan(fit.f0_lowest) && isnan(fit.f_inf_highest) && isnan(fit.student));
    }
    /* a change that the tolerance calls none, but sigma sees */
    const double f[] = {.64, .624, .615, .605, .6007}, sigma[] = {1e-3, 1e-3, 1e-3, 1e-3, 1e-3};
    def.tolerance = 0.05;
    assert_int_equal(blocking_fit_range(&def, t, f, sigma, 5, 80.0, low, high, NULL, NULL), BLOCKING_OK);
    assert_true(low[0] > .59 && high[0] < .61);
    /* a sieve that hardly blocks: in a third of the trials all five counts of 100 holes are equal */
    uint64_t seed = 7;
    int holds = 0, equal = 0;
    enum { TRIALS = 300 };
    def = blocking_default_fit_def();
    for (int i = 0; i < TRIALS; i++) {
        double counted[5], error[5];
        for (int j = 0; j < 5; j++) {
            int free_holes = 0;
            for (int hole = 0; hole < 100; hole++) free_holes += random_plain(&seed) < .998;
            const double share = (free_holes + 1.0) / 102.0; /* as examples/sieve_blocking/blocking_tests.h */
            counted[j] = free_holes / 100.0;
            error[j] = sqrt(share * (1.0 - share) / 100.0);
        }
        equal += counted[0] == counted[1] && counted[1] == counted[2] && counted[2] == counted[3] &&
                 counted[3] == counted[4];
        assert_int_equal(blocking_fit_range(&def, t, counted, error, 5, 80.0, low, high, NULL, NULL), BLOCKING_OK);
        holds += low[0] <= .998 && .998 <= high[0];
    }
    assert_true(equal > TRIALS / 5 && holds >= 0.93 * TRIALS);
}

/* The clock may start at any time: the range of f at a reading is the same. */
static void ranges_at_a_late_clock(void **state) {
    (void)state;
    blocking_fit_def def = blocking_default_fit_def();
    const double starts[] = {0, 100, 5000, 20000, 40000, 1048576, 1073741824}, after[] = {0, 4, 25, 50, 400, HUGE_VAL};
    for (int known = 0; known < 2; known++)
        for (size_t i = 0; i < LENGTH(after); i++) {
            double low_at_0 = nan_, high_at_0 = nan_;
            for (size_t s = 0; s < LENGTH(starts); s++) {
                double t[6], f[6], low, high, sigma[6];
                for (int j = 0; j < 6; j++) {
                    t[j] = starts[s] + 10 * j;
                    f[j] = blocking_curve(.9, .6, .05, 10.0 * j) + (j % 2 ? .002 : -.002);
                    sigma[j] = .002;
                }
                assert_int_equal(blocking_fit_range(&def, t, f, known ? sigma : NULL, 6, starts[s] + after[i], &low,
                                                    &high, NULL, NULL),
                                 BLOCKING_OK);
                if (s == 0) low_at_0 = low, high_at_0 = high;
                assert_true(low == low_at_0 && high == high_at_0);
                const double truth = blocking_curve(.9, .6, .05, after[i]);
                assert_true(low < truth && truth < high && high - low < .05);
            }
        }
    /* blocking_fit bounds f0 at t = 0, from where no curve leads to these: its ranges are of the readings
       all the same */
    double t[6], f[6], sigma[6], low, high, mean_low, mean_high;
    blocking_fit_result fit;
    for (int j = 0; j < 6; j++) t[j] = 20000 + 10 * j, f[j] = blocking_curve(.9, .6, .05, 10.0 * j), sigma[j] = 1e-7;
    assert_int_equal(blocking_fit(&def, t, f, sigma, 6, &fit), BLOCKING_NOT_SATURATING);
    assert_true(fit.f0 == 1.0 && fit.f_inf_highest > .6 && fit.f_inf_highest < .6 + 1e-6 && fit.k_highest > .05 &&
                fit.k_highest < .0501);
    /* between the clock's start and the first reading, and the mean from the clock's start on: readings of a curve
       known exactly */
    const double late = 100.0, k = .005;
    for (int j = 0; j < 6; j++) t[j] = late + 20 * j, f[j] = blocking_curve(.9, .6, k, 20.0 * j), sigma[j] = 1e-8;
    for (double T = 1.0; T < 1e6; T *= 3.0) {
        assert_int_equal(blocking_fit_range(&def, t, f, sigma, 6, T, &low, &high, &mean_low, &mean_high), BLOCKING_OK);
        const double value = .6 + .3 * exp(k * (late - T)), mean = .6 + .3 * exp(k * late) * -expm1(-k * T) / (k * T);
        near(low, value > 1.0 ? 0.0 : value, 1e-6); /* above 1 the curve cannot hold */
        near(high, value > 1.0 ? 1.0 : value, 1e-6);
        near(mean_low, mean > 1.0 ? 0.0 : mean, 1e-6);
        near(mean_high, mean > 1.0 ? 1.0 : mean, 1e-6);
    }
    /* so late that all curves come from beyond 1: nothing is known of the time before */
    for (int j = 0; j < 6; j++) t[j] += 1e6;
    assert_int_equal(blocking_fit_range(&def, t, f, sigma, 6, t[1], &low, &high, &mean_low, &mean_high), BLOCKING_OK);
    near(low, f[1], 1e-6);
    near(high, f[1], 1e-6);
    assert_true(mean_low == 0.0 && mean_high == 1.0);
    assert_int_equal(blocking_fit_range(&def, t, f, sigma, 6, 0.0, &low, &high, NULL, NULL), BLOCKING_OK);
    assert_true(low == 0.0 && high == 1.0);
}

/* No noisy set with more readings than unknowns is refused, and none is worse than the best curve on a border. */
static void noisy_sets(void **state) {
    (void)state;
    uint64_t seed = 8;
    blocking_fit_def def = blocking_default_fit_def();
    for (int i = 0; i < 2000; i++) {
        double t[9], f[9], now = 0.0, f0 = random_plain(&seed), f_inf = i % 3 ? random_plain(&seed) : i % 2,
                           k = exp(-6.0 * random_plain(&seed)), noise = i % 4 ? 0.03 : 0.3;
        int n = 4 + i % 6;
        for (int j = 0; j < n; j++) {
            t[j] = now;
            now += 0.1 + 20.0 * random_plain(&seed);
            f[j] = fmin(1.0, fmax(0.0, blocking_curve(f0, f_inf, k, t[j]) + noise * deviate(&seed)));
            if (i % 50 == 0 && j == 2) f[j] = i % 100 ? 1.0 : 0.0; /* an outlier */
        }
        blocking_fit_result fit;
        blocking_status status = blocking_fit(&def, t, f, NULL, (size_t)n, &fit);
        assert_true(status <= BLOCKING_NOT_RESOLVED);
        if (status == BLOCKING_NO_CHANGE) continue;
        assert_true(fit.k > 0.0 && fit.k_lowest <= fit.k && fit.k <= fit.k_highest && fit.f_inf_lowest <= fit.f_inf &&
                    fit.f_inf <= fit.f_inf_highest);
        double mean = 0.0, constant = 0.0, border[2] = {1e300, 1e300};
        for (int j = 0; j < n; j++) mean += f[j] / n;
        for (int j = 0; j < n; j++) constant += (f[j] - mean) * (f[j] - mean);
        for (int c = 0; c < 2; c++) /* f_inf = c, the best k and f0 of a fine grid */
            for (double x = -9.0; x < 6.0; x += 0.02) {
                double ee = 0.0, ef = 0.0, sse = 0.0, rate = exp(x);
                for (int j = 0; j < n; j++)
                    ee += exp(-2.0 * rate * t[j]), ef += exp(-rate * t[j]) * (f[j] - c + c * exp(-rate * t[j]));
                double start = fmin(1.0, fmax(0.0, ef / ee));
                for (int j = 0; j < n; j++) {
                    double miss = f[j] - c - (start - c) * exp(-rate * t[j]);
                    sse += miss * miss;
                }
                border[c] = fmin(border[c], sse);
            }
        double best = fmin(constant, fmin(border[0], border[1]));
        if (!(sqrt(fit.sse / n) <= sqrt(best / n) * (1.0 + 1e-9) + 1e-9))
            fail_msg("set %d: %.12g, on a border %.12g", i, fit.sse, best);
    }
}

static void on_off(void *user, double t, double *k1, double *k2) {
    const double *pulse = user; /* period, length */
    *k1 = fmod(t, pulse[0]) < pulse[1] ? .05 : .001;
    *k2 = .02;
}

static void pulses_are_seen(void **state) {
    (void)state;
    const double pulses[][2] = {{20, 10}, {60, 3}, {120, 20}, {7, 1}, {600, 5}, {2, .5}, {97.3, 4.1}};
    for (size_t i = 0; i < LENGTH(pulses); i++) {
        blocking_ode_def def = blocking_default_ode_def();
        double end = 600.0, f[2], mean[2], breaks[700];
        def.rates = on_off;
        def.user = (void *)(size_t)pulses[i];
        assert_int_equal(blocking_integrate(&def, &end, 1, &f[0], &mean[0], NULL), BLOCKING_OK);
        for (double t = 0.0; t < 600.0; t += pulses[i][0]) {
            if (t > 0.0) breaks[def.n_breaks++] = t;
            breaks[def.n_breaks++] = t + pulses[i][1];
        }
        def.breaks = breaks;
        assert_int_equal(blocking_integrate(&def, &end, 1, &f[1], &mean[1], NULL), BLOCKING_OK);
        near(f[0], f[1], 1e-10);
        near(mean[0], mean[1], 1e-10);
    }
}

/* k1 and k2 as exponentials of K and x_h: found again, with what the data do not tell left out, and a range at a
   place between */
static void laws_across_tests(void **state) {
    (void)state;
    enum { TESTS = 12, READINGS = 8 };
    static double t[READINGS] = {0, 5, 10, 20, 40, 80, 160, 320}, f[TESTS][READINGS];
    blocking_test tests[TESTS];
    uint64_t seed = 5;
    int held = 0, trials = 40, form = 0;
    for (int trial = 0; trial < trials; trial++) {
        for (int i = 0; i < TESTS; i++) {
            blocking_test one = {t, f[i], NULL, READINGS, 1.0 + i % 4, 0.2 + 0.3 * (i / 4), 0.0};
            double k1 = exp(-5.0 + 2.0 * one.x_h), k2 = exp(-4.5 + 0.4 * one.K);
            for (int j = 0; j < READINGS; j++)
                f[i][j] = blocking_free_fraction(1.0, k1, k2, t[j]) + 0.01 * deviate(&seed);
            for (int j = 0; j < READINGS; j++) f[i][j] = fmin(1.0, f[i][j]);
            tests[i] = one;
        }
        blocking_law law;
        blocking_law_value value;
        assert_int_equal(blocking_fit_law(tests, TESTS, &law, NULL), BLOCKING_OK);
        assert_true(law.aicc < law.aicc_constant && (law.used_a & 4) && (law.used_b & 2) &&
                    !((law.used_a | law.used_b) & 8));
        form += law.used_a == 5 && law.used_b == 3;
        assert_int_equal(blocking_law_at(&law, 2.5, 0.4, 0.0, &value), BLOCKING_OK);
        held += value.f_inf_low95 <= 1.0 / (1.0 + exp(-0.5 + 0.8 - 1.0)) &&
                1.0 / (1.0 + exp(-0.5 + 0.8 - 1.0)) <= value.f_inf_high95;
        assert_true(value.outside == 0 && value.k1_low95 < value.k1 && value.k1 < value.k1_high95);
        close_to(value.f_inf, value.k2 / (value.k1 + value.k2), 1e-12);
        blocking_law_at(&law, 6.0, 0.4, 0.02, &value);
        assert_int_equal(value.outside, 5);
    }
    assert_true(form > trials / 2 && held >= 34);
    blocking_law law;
    size_t bad;
    double old = f[3][2];
    f[3][2] = nan_;
    assert_int_equal(blocking_fit_law(tests, TESTS, &law, &bad), BLOCKING_NOT_FINITE);
    assert_true(bad == 3 && isnan(law.a[0]));
    f[3][2] = old;
    assert_int_equal(blocking_fit_law(tests, 0, &law, NULL), BLOCKING_TOO_FEW);
    assert_int_equal(blocking_fit_law(NULL, 2, &law, NULL), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_fit_law(tests, 1, NULL, NULL), BLOCKING_BAD_ARGUMENT);
    tests[0].n = 1;
    assert_int_equal(blocking_fit_law(tests, 1, &law, NULL), BLOCKING_TOO_FEW);
    tests[0].n = READINGS;
    /* one test: constant k1, k2, as blocking_fit */
    assert_int_equal(blocking_fit_law(tests, 1, &law, NULL), BLOCKING_OK);
    blocking_fit_def def = blocking_default_fit_def();
    blocking_fit_result fit;
    blocking_law_value value;
    blocking_fit(&def, t, f[0], NULL, READINGS, &fit);
    assert_true(law.used_a == 1 && law.used_b == 1);
    blocking_law_at(&law, tests[0].K, tests[0].x_h, 0.0, &value);
    close_to(value.k1 + value.k2, fit.k, 1e-5);
    near(value.f_inf, fit.f_inf, 1e-5);
    assert_int_equal(blocking_law_at(&law, nan_, 0, 0, &value), BLOCKING_NOT_FINITE);
    assert_int_equal(blocking_law_at(NULL, 1, 0, 0, &value), BLOCKING_BAD_ARGUMENT);
    assert_true(isnan(value.k1));
}

/* The ranges that a law gives for a deck, f and its mean over a run, and the area for a duty, hold the truth in 95
   of 100; drawn pairs of k1 and k2 say the same. RIDDLE_TRIALS: how many; without it few. */
static void laws_reach_the_deck(void **state) {
    (void)state;
    enum { TESTS = 6, READINGS = 7, RUNS = 3, DRAWS = 400 };
    static const double t[READINGS] = {0, 5, 15, 40, 80, 160, 320}, T[RUNS] = {30.0, 600.0, HUGE_VAL};
    static double f[TESTS][READINGS];
    const char *setting = getenv("RIDDLE_TRIALS");
    const int trials = setting ? atoi(setting) : 60;
    const double true_k1 = exp(-5.0 + 2.0 * 0.4), true_k2 = exp(-4.5 + 0.4 * 2.5);
    uint64_t seed = 11;
    int in_last[RUNS] = {0}, in_mean[RUNS] = {0}, in_area = 0, in_draws = 0;
    for (int trial = 0; trial < trials; trial++) {
        blocking_test tests[TESTS];
        for (int i = 0; i < TESTS; i++) {
            blocking_test one = {t, f[i], NULL, READINGS, 1.0 + 3.0 * (i % 2), 0.2 + 0.3 * (i / 2), 0.0};
            double k1 = exp(-5.0 + 2.0 * one.x_h), k2 = exp(-4.5 + 0.4 * one.K);
            for (int j = 0; j < READINGS; j++)
                f[i][j] = fmin(1.0, blocking_free_fraction(0.97, k1, k2, t[j]) + 0.01 * deviate(&seed));
            tests[i] = one;
        }
        blocking_law law;
        blocking_law_run run;
        assert_int_equal(blocking_fit_law(tests, TESTS, &law, NULL), BLOCKING_OK);
        for (int r = 0; r < RUNS; r++) {
            const double k = true_k1 + true_k2, last = blocking_curve(1.0, true_k2 / k, k, T[r]),
                         mean = blocking_time_mean(1.0, true_k2 / k, k, T[r]);
            assert_int_equal(blocking_law_free(&law, 2.5, 0.4, 0.0, 1.0, T[r], &run), BLOCKING_OK);
            assert_true(run.last_low95 < run.last && run.last < run.last_high95 && run.mean_low95 < run.mean &&
                        run.mean < run.mean_high95);
            in_last[r] += run.last_low95 <= last && last <= run.last_high95;
            in_mean[r] += run.mean_low95 <= mean && mean <= run.mean_high95;
            if (r != 1) continue;
            blocking_duty duty = blocking_default_duty();
            blocking_deck deck;
            duty.passing = 1.0, duty.capacity = 2.0, duty.clearance = 0.4, duty.run_time = T[r];
            blocking_law_value value;
            blocking_law_at(&law, 2.5, 0.4, 0.0, &value);
            duty.f_inf = value.f_inf, duty.k = value.k1 + value.k2;
            duty.mean_lowest = run.mean_low95, duty.mean_highest = run.mean_high95;
            assert_int_equal(blocking_design(&duty, &deck), BLOCKING_OK);
            in_area += deck.area_mean_low95 <= 0.5 / 0.4 / mean && 0.5 / 0.4 / mean <= deck.area_mean_high95;
            double drawn[DRAWS], k1, k2;
            int below = 0;
            for (int i = 0; i < DRAWS; i++) {
                assert_int_equal(blocking_law_draw(&law, 2.5, 0.4, 0.0, deviate(&seed), deviate(&seed), &k1, &k2),
                                 BLOCKING_OK);
                drawn[i] = blocking_time_mean(1.0, k2 / (k1 + k2), k1 + k2, T[r]);
                below += drawn[i] < mean;
            }
            in_draws += below >= 0.025 * DRAWS && below <= 0.975 * DRAWS;
        }
    }
    for (int r = 0; r < RUNS; r++)
        if (setting)
            print_message("after %g s: f %.3f, mean %.3f held\n", T[r], (double)in_last[r] / trials,
                          (double)in_mean[r] / trials);
    if (setting) print_message("area %.3f, draws %.3f held\n", (double)in_area / trials, (double)in_draws / trials);
    const double least = setting ? 0.92 : 0.85, most = setting ? 0.975 : 1.0;
    for (int r = 0; r < RUNS; r++) {
        assert_true(in_last[r] >= least * trials && in_last[r] <= most * trials);
        assert_true(in_mean[r] >= least * trials && in_mean[r] <= most * trials);
    }
    assert_true(in_area == in_mean[1] && in_draws >= (least - 0.01) * trials && in_draws <= most * trials);
}

static void laws_refuse(void **state) {
    (void)state;
    static const double t[] = {0, 5, 10, 20, 40, 80}, f[] = {1.0, 0.95, 0.91, 0.87, 0.80, 0.77};
    const blocking_test one = {t, f, NULL, 6, 2.0, 0.4, 0.0};
    const double bad[] = {nan_, HUGE_VAL, -HUGE_VAL};
    blocking_law law;
    blocking_law_run run;
    blocking_law_value value;
    double k1, k2;
    assert_int_equal(blocking_fit_law(&one, 1, &law, NULL), BLOCKING_OK);
    blocking_law_at(&law, 2.0, 0.4, 0.0, &value);
    assert_int_equal(blocking_law_draw(&law, 2.0, 0.4, 0.0, 0.0, 0.0, &k1, &k2), BLOCKING_OK);
    close_to(k1, value.k1, 1e-13);
    close_to(k2, value.k2, 1e-13);
    /* at once: what it begins with */
    assert_int_equal(blocking_law_free(&law, 2.0, 0.4, 0.0, 0.9, 0.0, &run), BLOCKING_OK);
    assert_true(run.last == 0.9 && run.last_low95 == 0.9 && run.last_high95 == 0.9 && run.mean_high95 == 0.9 &&
                run.outside == 0);
    assert_int_equal(blocking_law_free(&law, 2.0, 0.4, 0.0, 1.0, HUGE_VAL, &run), BLOCKING_OK);
    close_to(run.last, value.f_inf, 1e-13);
    near(run.last_low95, value.f_inf_low95, 1e-4); /* of the odds alone: the same edge, met at 256 places */
    near(run.last_high95, value.f_inf_high95, 1e-4);
    assert_int_equal(blocking_law_free(&law, 9.0, 0.4, 0.0, 1.0, 10.0, &run), BLOCKING_OK);
    assert_int_equal(run.outside, 1);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(blocking_law_free(&law, bad[i], 0.4, 0.0, 1.0, 10.0, &run), BLOCKING_NOT_FINITE);
        assert_true(isnan(run.last) && isnan(run.mean_low95) && isnan(run.mean_high95));
        assert_true(blocking_law_free(&law, 2.0, 0.4, 0.0, bad[i], 10.0, &run) != BLOCKING_OK && isnan(run.mean));
        assert_int_equal(blocking_law_draw(&law, 2.0, 0.4, 0.0, bad[i], 0.0, &k1, &k2), BLOCKING_NOT_FINITE);
        assert_int_equal(blocking_law_draw(&law, 2.0, 0.4, 0.0, 0.0, bad[i], &k1, &k2), BLOCKING_NOT_FINITE);
        assert_true(isnan(k1) && isnan(k2));
    }
    assert_int_equal(blocking_law_draw(&law, 2.0, 0.4, 0.0, 1e6, 0.0, &k1, &k2), BLOCKING_NOT_FINITE);
    assert_int_equal(blocking_law_free(&law, 2.0, 0.4, 0.0, 1.1, 10.0, &run), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_law_free(&law, 2.0, 0.4, 0.0, 1.0, -1.0, &run), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_law_free(NULL, 2.0, 0.4, 0.0, 1.0, 1.0, &run), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_law_free(&law, 2.0, 0.4, 0.0, 1.0, 1.0, NULL), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_law_draw(&law, 2.0, 0.4, 0.0, 0.0, 0.0, NULL, &k2), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_law_draw(NULL, 2.0, 0.4, 0.0, 0.0, 0.0, &k1, &k2), BLOCKING_BAD_ARGUMENT);
}

/* Finite numbers whose products are not: refused where they enter. */
static void overflow(void **state) {
    (void)state;
    const double tiny[] = {0, 1e-308, 2e-308}, subnormal[] = {0, 5e-324, 1e-323}, far_off[] = {1e6, 1e6 + 1, 1e6 + 2},
                 f[] = {.9, .8, .75};
    blocking_estimate e;
    assert_int_equal(blocking_three_point(tiny, f, .01, 1e-9, &e), BLOCKING_NOT_FINITE);
    assert_true(isnan(e.k) && isnan(e.error_k));
    assert_int_equal(blocking_three_point(subnormal, f, .01, 1e-9, &e), BLOCKING_NOT_FINITE);
    assert_int_equal(blocking_three_point(far_off, f, .01, 1e-9, &e), BLOCKING_OUT_OF_RANGE);
    assert_true(isfinite(e.k) && isfinite(e.f_inf) && isnan(e.f0));
    blocking_hard hard;
    const double d[] = {.001, .0011, .002}, mass[] = {1e308, 1e308, 1e308};
    assert_int_equal(blocking_hard_from_classes(d, mass, 3, .001, &hard), BLOCKING_NOT_FINITE);
    blocking_duty duty = blocking_default_duty();
    blocking_deck deck;
    duty.passing = 1e300, duty.capacity = 1.0, duty.clearance = 1e-300, duty.f_inf = 0.5, duty.k = 0.1;
    assert_int_equal(blocking_design(&duty, &deck), BLOCKING_BAD_DEF);
}

/* ---- Table 3 ---- */

static void table_3(void **state) {
    (void)state;
    const struct {
        blocking_shape shape;
        double K, x_h, f;
    } exact[] = {{BLOCKING_SPHERICAL, 1.5, .9, .824625},        {BLOCKING_SPHERICAL, 3.5, 0, .998375},
                 {BLOCKING_SPHERICAL, .62, 1, .673414152},      {BLOCKING_SPHERICAL, 5, 1, 1.002},
                 {BLOCKING_IRREGULAR, 1.98, .5, .871418272},    {BLOCKING_IRREGULAR, 3.5, 0, 1.040625},
                 {BLOCKING_IRREGULAR, .62, 1, .569470744},      {BLOCKING_IRREGULAR, 5, 1, .919},
                 {BLOCKING_SHARP_AS_PRINTED, 1.5, .9, .949302}, {BLOCKING_SHARP_AS_PRINTED, 1.98, .5, .882587696},
                 {BLOCKING_SHARP_AS_PRINTED, 3.5, 0, .997875},  {BLOCKING_SHARP_AS_PRINTED, 5, 1, 1.2777},
                 {BLOCKING_SHARP_REPAIRED, 1.5, .9, .677385},   {BLOCKING_IRREGULAR, 1.5, .9, .781528},
                 {BLOCKING_SPHERICAL, 10, .5, 3.62675}};
    for (size_t i = 0; i < LENGTH(exact); i++)
        near(blocking_table3(exact[i].shape, exact[i].K, exact[i].x_h), exact[i].f, 1e-14);

    /* the same by the general polynomial of eq 16, with the powers in the order of the print */
    const int powers[10][2] = {{1, 2}, {0, 3}, {0, 2}, {0, 1}, {1, 1}, {2, 1}, {0, 0}, {1, 0}, {2, 0}, {3, 0}};
    for (int s = 0; s < BLOCKING_SHAPE_COUNT; s++) {
        double a[10], h = 1e-6;
        blocking_table3_coefficients((blocking_shape)s, a);
        for (int i = 0; i < 50; i++) {
            double x[2] = {.6 + .09 * i, .02 * i};
            near(blocking_polynomial(a, &powers[0][0], 10, x, 2), blocking_table3((blocking_shape)s, x[0], x[1]),
                 3e-15);
            double slope = (blocking_table3((blocking_shape)s, x[0], x[1] + h) -
                            blocking_table3((blocking_shape)s, x[0], x[1] - h)) /
                           (2 * h);
            near(blocking_table3_slope((blocking_shape)s, x[0], x[1]), slope, 1e-8);
        }
    }
    assert_true(isnan(blocking_table3(BLOCKING_SHAPE_COUNT, 1, 1)) &&
                isnan(blocking_table3_slope((blocking_shape)77, 1, 1)));

    /* ranges and shares over K 0.6..5, x_h 0..1 */
    const struct {
        double least, most, above, rising;
    } plane[] = {{.5979, 1.07915, .285, .339},
                 {.5627, 1.08476, .092, .0},
                 {.6698, 1.2777, .217, .52},
                 {.5188, 1.0239, .033, .17}};
    for (int s = 0; s < BLOCKING_SHAPE_COUNT; s++) {
        double least = 9, most = -9;
        int above = 0, rising = 0;
        const int n = 500;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                double K = .6 + 4.4 * (i + .5) / n, x = (j + .5) / n, f = blocking_table3((blocking_shape)s, K, x);
                above += f > 1.0;
                rising += blocking_table3_slope((blocking_shape)s, K, x) > 0.0;
                f = blocking_table3((blocking_shape)s, .6 + 4.4 * i / (n - 1), (double)j / (n - 1));
                least = fmin(least, f);
                most = fmax(most, f);
            }
        near(least, plane[s].least, 1e-4);
        near(most, plane[s].most, 1e-4);
        near((double)above / n / n, plane[s].above, 1e-3);
        near((double)rising / n / n, plane[s].rising, 6e-3);
    }
    /* Fig 9 at K = 1.5, x_h = 0.9 has sharp-edged lowest: only the repaired row does */
    assert_true(blocking_table3(BLOCKING_SHARP_AS_PRINTED, 1.5, .9) > blocking_table3(BLOCKING_SPHERICAL, 1.5, .9));
    assert_true(blocking_table3(BLOCKING_SHARP_REPAIRED, 1.5, .9) < blocking_table3(BLOCKING_IRREGULAR, 1.5, .9) &&
                blocking_table3(BLOCKING_IRREGULAR, 1.5, .9) < blocking_table3(BLOCKING_SPHERICAL, 1.5, .9));
}

static void averages_with_flags(void **state) {
    (void)state;
    blocking_average a;
    blocking_conditions c = blocking_default_conditions();
    assert_int_equal(blocking_average_free(BLOCKING_SPHERICAL, &c, &a), BLOCKING_NOT_FINITE); /* K must be set */
    c.K = 1.5;
    c.x_h = .9;
    assert_int_equal(blocking_average_free(BLOCKING_SPHERICAL, &c, &a), BLOCKING_OK);
    near(a.value, .824625, 1e-14);
    assert_true(a.raw == a.value && a.flags == BLOCKING_FLAG_RISING);
    c.x_h = .5;
    assert_int_equal(blocking_average_free(BLOCKING_IRREGULAR, &c, &a), BLOCKING_OK);
    assert_int_equal(a.flags, 0);
    c.K = 3.5;
    c.x_h = 0.0;
    assert_int_equal(blocking_average_free(BLOCKING_IRREGULAR, &c, &a), BLOCKING_OK);
    near(a.raw, 1.040625, 1e-14);
    assert_true(a.value == 1.0 && a.flags == BLOCKING_FLAG_ABOVE_ONE);
    c.K = 5;
    c.x_h = 1;
    assert_int_equal(blocking_average_free(BLOCKING_SHARP_AS_PRINTED, &c, &a), BLOCKING_OK);
    assert_int_equal(a.flags, BLOCKING_FLAG_K | BLOCKING_FLAG_ABOVE_ONE | BLOCKING_FLAG_RISING);
    c.K = 50;
    c.x_h = 0.5;
    assert_int_equal(blocking_average_free(BLOCKING_IRREGULAR, &c, &a), BLOCKING_OK);
    assert_true(a.flags & BLOCKING_FLAG_K);
    const double ends[] = {0.62, 4.9};
    for (int i = 0; i < 2; i++) {
        c.K = ends[i];
        assert_int_equal(blocking_outside_box(&c), 0);
    }
    c.opening = 8e-3; /* the batch screen: outside on every side */
    c.grain_max = 10e-3;
    c.moisture = 0.025;
    c.K = 10.3;
    assert_int_equal(blocking_outside_box(&c), BLOCKING_FLAG_BOX);
    assert_int_equal(blocking_outside_box(NULL), BLOCKING_FLAG_BOX);
    c.grain_min = c.opening = c.moisture = c.K = nan_;
    assert_int_equal(blocking_outside_box(&c), BLOCKING_FLAG_BOX);
    c = blocking_default_conditions();
    c.K = 1.5;
    c.x_h = 90;
    assert_int_equal(blocking_average_free(BLOCKING_SPHERICAL, &c, &a), BLOCKING_IN_PERCENT);
    assert_true(isnan(a.value));
    c.x_h = -.1;
    assert_int_equal(blocking_average_free(BLOCKING_SPHERICAL, &c, &a), BLOCKING_NEGATIVE);
    c.x_h = .5;
    c.K = -1;
    assert_int_equal(blocking_average_free(BLOCKING_SPHERICAL, &c, &a), BLOCKING_NEGATIVE);
    c.K = 1;
    assert_int_equal(blocking_average_free(BLOCKING_SHAPE_COUNT, &c, &a), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_average_free(BLOCKING_SPHERICAL, NULL, &a), BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_average_free(BLOCKING_SPHERICAL, &c, NULL), BLOCKING_BAD_ARGUMENT);
}

/* ---- eq 16 ---- */

static void polynomials(void **state) {
    (void)state;
    int powers[40][3];
    assert_int_equal(blocking_polynomial_powers(2, 3, NULL, 0), 10);
    assert_int_equal(blocking_polynomial_powers(2, 2, &powers[0][0], 40), 6);
    const int quadratic[12] = {0, 0, 1, 0, 0, 1, 2, 0, 1, 1, 0, 2};
    assert_memory_equal(powers, quadratic, sizeof quadratic);
    assert_int_equal(blocking_polynomial_powers(3, 3, &powers[0][0], 40), 20);
    for (int i = 0; i < 20; i++) {
        int degree = powers[i][0] + powers[i][1] + powers[i][2];
        assert_true(degree <= 3 && (i == 0 || degree >= powers[i - 1][0] + powers[i - 1][1] + powers[i - 1][2]));
        for (int j = 0; j < i; j++) assert_true(memcmp(powers[i], powers[j], sizeof powers[i]) != 0);
    }
    assert_int_equal(blocking_polynomial_powers(1, 5, &powers[0][0], 40), 6);
    assert_int_equal((&powers[0][0])[5], 5);
    assert_int_equal(blocking_polynomial_powers(4, 0, &powers[0][0], 40), 1);
    assert_int_equal(blocking_polynomial_powers(0, 3, NULL, 0), 0);
    assert_int_equal(blocking_polynomial_powers(2, -1, NULL, 0), 0);
    assert_int_equal(blocking_polynomial_powers(1000, 1000, NULL, 0), 0);

    /* Table 3 back from its own values at the five measured K and eleven x_h */
    const double measured[] = {.62, 1.5, 1.98, 3.5, 4.9};
    double x[55][2], y[55], a[10], error[10], printed[10], work[BLOCKING_POLYNOMIAL_WORK(55, 10)];
    const int order[10][2] = {{1, 2}, {0, 3}, {0, 2}, {0, 1}, {1, 1}, {2, 1}, {0, 0}, {1, 0}, {2, 0}, {3, 0}};
    blocking_polynomial_report report;
    for (int s = 0; s < BLOCKING_SHAPE_COUNT; s++) {
        for (int i = 0; i < 55; i++) {
            x[i][0] = measured[i / 11];
            x[i][1] = .1 * (i % 11);
            y[i] = blocking_table3((blocking_shape)s, x[i][0], x[i][1]);
        }
        blocking_table3_coefficients((blocking_shape)s, printed);
        assert_int_equal(blocking_polynomial_fit(&x[0][0], y, 55, &order[0][0], 10, 2, a, error, work, &report),
                         BLOCKING_OK);
        for (int i = 0; i < 10; i++) near(a[i], printed[i], 1e-13);
        near(report.r2, 1.0, 1e-14);
        assert_int_equal(report.term, 10);
    }
    /* a straight line with textbook errors: y = 1 + 2 x + (1, -1, -1, 1)/10 at x = 0..3 */
    const double line_x[] = {0, 1, 2, 3}, line_y[] = {1.1, 2.9, 4.9, 7.1};
    const int line[] = {0, 1};
    assert_int_equal(blocking_polynomial_fit(line_x, line_y, 4, line, 2, 1, a, error, work, &report), BLOCKING_OK);
    near(a[0], 1.0, 1e-14);
    near(a[1], 2.0, 1e-14);
    near(report.sse, 0.04, 1e-14);
    near(report.deviation, sqrt(0.02), 1e-14);
    near(error[1], sqrt(0.02 / 5.0), 1e-14);
    near(error[0], sqrt(0.02 * 14.0 / 20.0), 1e-14);
    near(report.r2, 1.0 - 0.04 / 20.04, 1e-14);
    const double constants[] = {0.1, 0.7, 3.3, 1e5 / 3.0}; /* equal values have no spread, though their sum rounds */
    for (size_t i = 0; i < LENGTH(constants); i++) {
        double at[7], same[7];
        for (int j = 0; j < 7; j++) at[j] = 0.37 * j, same[j] = constants[i];
        assert_int_equal(blocking_polynomial_fit(at, same, 7, line, 2, 1, a, error, work, &report), BLOCKING_OK);
        assert_true(isnan(report.r2));
        close_to(a[0], constants[i], 1e-14);
    }

    /* what the points cannot tell apart is named: one K only, so K^2 is a multiple of 1 */
    for (int i = 0; i < 55; i++) x[i][0] = 1.5;
    assert_int_equal(blocking_polynomial_fit(&x[0][0], y, 55, &order[0][0], 10, 2, a, error, work, &report),
                     BLOCKING_UNDETERMINED);
    assert_true(report.term == 2 && isnan(a[0]) && isnan(error[0])); /* x^2 beside K x^2 */
    assert_int_equal(blocking_polynomial_fit(&x[0][0], y, 9, &order[0][0], 10, 2, a, error, work, NULL),
                     BLOCKING_TOO_FEW);
    assert_int_equal(blocking_polynomial_fit(&x[0][0], y, 0, &order[0][0], 0, 2, NULL, NULL, NULL, NULL),
                     BLOCKING_TOO_FEW);
    assert_int_equal(blocking_polynomial_fit(NULL, y, 55, &order[0][0], 10, 2, a, error, work, NULL),
                     BLOCKING_BAD_ARGUMENT);
    assert_int_equal(blocking_polynomial_fit(&x[0][0], y, 55, &order[0][0], 10, 2, NULL, error, work, NULL),
                     BLOCKING_BAD_ARGUMENT);
    const int minus[] = {0, -1};
    assert_int_equal(blocking_polynomial_fit(line_x, line_y, 4, minus, 2, 1, a, error, work, NULL),
                     BLOCKING_BAD_ARGUMENT);
    assert_true(isnan(blocking_polynomial(line_x, minus, 2, line_y, 1)));
    const double unknown[] = {1, 2, nan_, 4};
    assert_int_equal(blocking_polynomial_fit(line_x, unknown, 4, line, 2, 1, a, error, work, NULL),
                     BLOCKING_NOT_FINITE);
    assert_int_equal(blocking_polynomial_fit(unknown, line_y, 4, line, 2, 1, a, error, work, NULL),
                     BLOCKING_NOT_FINITE);
    const double zero[] = {0.0};
    const int nothing[] = {0};
    const double one[] = {1.0};
    near(blocking_polynomial(one, nothing, 1, zero, 1), 1.0, 0.0); /* 0^0 = 1 */
    near(blocking_polynomial(one, nothing, 0, zero, 1), 0.0, 0.0);
}

/* ---- deck area ---- */

static void deck_area(void **state) {
    (void)state;
    near(blocking_open_area(.63e-3, .4e-3), 0.37411631633518711, 1e-15);
    near(blocking_effective_area(.8, 2.0, .36), .576, 1e-15);
    near(blocking_clearance(.8, .36), .288, 1e-15);
    assert_true(isnan(blocking_open_area(0, 1)) && isnan(blocking_open_area(1, -1)) &&
                isnan(blocking_open_area(nan_, 1)) && isnan(blocking_effective_area(1.1, 1, .5)) &&
                isnan(blocking_effective_area(.5, -1, .5)) && isnan(blocking_clearance(.5, 37)) &&
                isnan(blocking_clearance(nan_, .5)));

    blocking_duty good = blocking_default_duty(), duty;
    blocking_deck deck;
    const char *field;
    assert_int_equal(blocking_check_duty(&good, &field), BLOCKING_BAD_DEF);
    assert_string_equal(field, "passing");
    good.passing = 0.08;
    good.capacity = 0.5;
    good.clearance = .36;
    good.f0 = .949;
    good.f_inf = .714;
    good.k = .0101;
    good.run_time = 60.0;
    assert_int_equal(blocking_design(&good, &deck), BLOCKING_OK);
    near(deck.free_mean, 0.890238899484432, 1e-14);
    near(deck.free_lowest, blocking_curve(.949, .714, .0101, 60.0), 1e-15);
    near(deck.effective_area, .16, 1e-15);
    near(deck.area_clean, .16 / .36, 1e-15);
    near(blocking_effective_area(deck.free_mean, deck.area_mean, .36), .16, 1e-15); /* eq 17 back */
    near(blocking_effective_area(deck.free_lowest, deck.area_lowest, .36), .16, 1e-15);
    duty = good;
    duty.run_time = HUGE_VAL;
    assert_int_equal(blocking_design(&duty, &deck), BLOCKING_OK);
    near(deck.free_mean, .714, 0.0);
    near(deck.area_mean, deck.area_lowest, 0.0);
    duty.f0 = .5; /* frees itself: the start is the worst */
    assert_int_equal(blocking_design(&duty, &deck), BLOCKING_OK);
    near(deck.free_lowest, .5, 0.0);
    duty.f_inf = 0.0;
    assert_int_equal(blocking_design(&duty, &deck), BLOCKING_OK);
    assert_true(isinf(deck.area_mean) && isinf(deck.area_lowest) && deck.area_clean > 0.0);
#define BAD_DUTY(change, name)                                                                                         \
    duty = good;                                                                                                       \
    change;                                                                                                            \
    assert_int_equal(blocking_check_duty(&duty, &field), BLOCKING_BAD_DEF);                                            \
    assert_string_equal(field, name);                                                                                  \
    assert_int_equal(blocking_design(&duty, &deck), BLOCKING_BAD_DEF);                                                 \
    assert_true(isnan(deck.area_mean))
    BAD_DUTY(duty.cookie = 0, "cookie");
    BAD_DUTY(duty.passing = 0.0, "passing");
    BAD_DUTY(duty.capacity = HUGE_VAL, "capacity");
    BAD_DUTY((duty.passing = 1e-300, duty.capacity = 1e300), "capacity");
    BAD_DUTY(duty.clearance = 36.0, "clearance");
    BAD_DUTY(duty.f0 = 95.0, "f0");
    BAD_DUTY(duty.f_inf = nan_, "f_inf");
    BAD_DUTY(duty.k = -1.0, "k");
    BAD_DUTY(duty.run_time = nan_, "run_time");
    assert_int_equal(blocking_check_duty(NULL, &field), BLOCKING_BAD_DEF);
    assert_string_equal(field, "duty");
    assert_int_equal(blocking_check_duty(&good, &field), BLOCKING_OK);
    assert_null(field);
    assert_int_equal(blocking_design(NULL, &deck), BLOCKING_BAD_DEF);
    assert_int_equal(blocking_design(&good, NULL), BLOCKING_BAD_ARGUMENT);
}

/* ---- any number whatever ---- */

/* Zeros, denormals, the largest, infinities, NaN, percents, negatives and, mostly, fractions */
static double any(uint64_t *s) {
    static const double odd[] = {0,  -0.0,    1,  0.5,  4.9e-324, 1e-300,   1e300,    DBL_MAX,
                                 -1, -1e-300, 95, 1e-9, 1e9,      HUGE_VAL, -HUGE_VAL};
    size_t pick = (size_t)(40.0 * random_plain(s));
    if (pick < LENGTH(odd)) return odd[pick];
    if (pick == LENGTH(odd)) return nan_;
    return pick < 32 ? random_plain(s) : 100.0 * random_plain(s);
}

static void any_rates(void *user, double t, double *k1, double *k2) {
    uint64_t *s = (uint64_t *)user;
    int wild = random_plain(s) < 0.1;
    *k1 = wild ? any(s) : 0.01 * (1.0 + sin(t));
    *k2 = wild ? any(s) : 0.2;
}

/* What comes out is NaN, refused, or within the promised range; the sanitizers watch the rest. */
static void any_numbers(void **state) {
    (void)state;
    uint64_t s = 41;
    int fitted = 0, estimated = 0, integrated = 0;
    for (int i = 0; i < 40000; i++) {
        const double a = any(&s), b = any(&s), c = any(&s), d = any(&s), e = any(&s);
        double f = blocking_free_fraction(a, b, c, d), later = blocking_time_for_exposure(a, b, c, d),
               K = blocking_toss_indicator(a, b, c, d, e);
        assert_true(isnan(f) || (f >= 0.0 && f <= 1.0));
        assert_true(isnan(later) || later >= 0.0);
        assert_true(isnan(K) || K >= 0.0);
        f = blocking_time_mean(a, b, c, d);
        assert_true(isnan(f) || (f >= fmin(a, b) && f <= fmax(a, b)));
        f = blocking_time_to(a, b, c, d);
        assert_true(isnan(f) || f >= 0.0);
        f = blocking_clearance(a, b);
        assert_true(isnan(f) || (f >= 0.0 && f <= 1.0));

        double t[8], g[8], sigma[8], mean[8], now = 0.0;
        size_t n = (size_t)(9.0 * random_plain(&s));
        for (int j = 0; j < 8; j++) {
            now += random_plain(&s) < 0.05 ? any(&s) : 10.0 * random_plain(&s);
            t[j] = now;
            g[j] = random_plain(&s) < 0.05 ? any(&s) : random_plain(&s);
            sigma[j] = random_plain(&s) < 0.02 ? any(&s) : 0.01;
        }
        blocking_estimate estimate;
        blocking_status status = blocking_three_point(t, g, i % 10 ? 0.01 : a, i % 7 ? 1e-9 : b, &estimate);
        if (status == BLOCKING_OK || status == BLOCKING_OUT_OF_RANGE) {
            estimated++;
            assert_true(estimate.k > 0.0 && estimate.f_inf_clipped >= 0.0 && estimate.f_inf_clipped <= 1.0 &&
                        estimate.k1 >= 0.0);
        } else assert_true(isnan(estimate.k));
        if (i % 10 == 0) {
            blocking_fit_def def = blocking_default_fit_def();
            blocking_fit_result fit;
            if (i % 100 == 0) def.k_low = a, def.k_high = b, def.z = c, def.turn_back = d;
            status = blocking_fit(&def, t, g, i % 20 ? sigma : NULL, n, &fit);
            if (status == BLOCKING_OK || (status >= BLOCKING_NON_MONOTONE && status <= BLOCKING_NOT_RESOLVED)) {
                fitted++;
                assert_true(fit.k > 0.0 && fit.f0 >= 0.0 && fit.f0 <= 1.0 && fit.f_inf >= 0.0 && fit.f_inf <= 1.0 &&
                            fit.sse >= 0.0);
                assert_true(isnan(fit.k_lowest) ||
                            (fit.k_lowest <= fit.k * (1 + 1e-9) && fit.k_highest >= fit.k * (1 - 1e-9)));
            } else assert_true(isnan(fit.k));
        }
        if (i % 10 == 1) {
            blocking_ode_def def = blocking_default_ode_def();
            double out[8];
            def.rates = any_rates;
            def.user = &s;
            def.f0 = i % 100 < 50 ? random_plain(&s) : a;
            def.tolerance = 1e-3;
            def.max_steps = 200;
            def.breaks = sigma;
            def.n_breaks = i % 30 == 1 ? 1 : 0;
            if (i % 200 == 1) def.max_step = b;
            status = blocking_integrate(&def, t, n, out, mean, NULL);
            integrated += status == BLOCKING_OK;
            for (size_t j = 0; j < n; j++) {
                assert_true(isnan(out[j]) ? status != BLOCKING_OK : out[j] >= 0.0 && out[j] <= 1.0);
                assert_true(isnan(mean[j]) ? status != BLOCKING_OK : mean[j] >= 0.0 && mean[j] <= 1.0);
            }
        }
        blocking_hard hard;
        status = i % 2 ? blocking_hard_from_classes(t, g, n, a, &hard) : blocking_hard_from_curve(t, g, n, a, &hard);
        assert_true(status == BLOCKING_OK ? hard.below >= 0.0 && hard.above >= 0.0 && hard.x_h <= 1.0 + 1e-12
                                          : isnan(hard.x_h));
        blocking_conditions conditions = {a, b, c, d, e, a};
        blocking_average average;
        status = blocking_average_free((blocking_shape)(i % 5), &conditions, &average);
        assert_true(status == BLOCKING_OK ? average.value >= 0.0 && average.value <= 1.0 : isnan(average.value));
        blocking_duty duty = blocking_default_duty();
        blocking_deck deck;
        duty.passing = a;
        duty.capacity = b;
        duty.clearance = c;
        duty.f_inf = d;
        duty.k = e;
        status = blocking_design(&duty, &deck);
        assert_true(status == BLOCKING_OK ? deck.area_lowest >= deck.area_clean : isnan(deck.area_mean));
        double work[BLOCKING_POLYNOMIAL_WORK(8, 2)], two[2], error[2];
        const int line[2] = {0, 1};
        status = blocking_polynomial_fit(t, g, n, line, 2, 1, two, error, work, NULL);
        assert_true(status == BLOCKING_OK || isnan(two[0]));
    }
    assert_true(fitted > 500 && estimated > 500 && integrated > 100);
}

static void texts(void **state) {
    (void)state;
    for (int i = 0; i < BLOCKING_STATUS_COUNT; i++)
        for (int j = 0; j < i; j++)
            assert_string_not_equal(blocking_status_text((blocking_status)i), blocking_status_text((blocking_status)j));
    assert_string_equal(blocking_status_text(BLOCKING_OK), "ok");
    assert_non_null(strstr(blocking_status_text(BLOCKING_IN_PERCENT), "percent"));
    assert_string_equal(blocking_status_text(BLOCKING_STATUS_COUNT), "unknown status");
    assert_string_equal(blocking_status_text((blocking_status)999), "unknown status");
    assert_string_equal(blocking_toss_text((blocking_toss)999), "unknown range");
    assert_non_null(strstr(blocking_toss_text(BLOCKING_TOSS_HARD), "7-10"));
    assert_string_equal(blocking_shape_text(BLOCKING_SHARP_REPAIRED), "sharp-edged (repaired)");
    assert_string_equal(blocking_shape_text((blocking_shape)-1), "unknown shape");
    for (unsigned flag = 1; flag <= 64; flag *= 2) assert_string_not_equal(blocking_flag_text(flag), "unknown flag");
    assert_string_equal(blocking_flag_text(BLOCKING_FLAG_BOX), "unknown flag");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(grains_and_vibration),
        cmocka_unit_test(hard_content),
        cmocka_unit_test(counted_holes),
        cmocka_unit_test(curves_of_table_2),
        cmocka_unit_test(curves_to_the_last_digits),
        cmocka_unit_test(invariants),
        cmocka_unit_test(degenerate_curves),
        cmocka_unit_test(constant_rates_are_exact),
        cmocka_unit_test(changing_rates),
        cmocka_unit_test(periodic_rates),
        cmocka_unit_test(jumps),
        cmocka_unit_test(schedules),
        cmocka_unit_test(bad_integrations),
        cmocka_unit_test(three_points),
        cmocka_unit_test(three_point_statuses),
        cmocka_unit_test(noise),
        cmocka_unit_test(fits_recover_exact_data),
        cmocka_unit_test(fit_statuses),
        cmocka_unit_test(fit_intervals_cover),
        cmocka_unit_test(student),
        cmocka_unit_test(ranges_cover),
        cmocka_unit_test(fits_of_counted_holes),
        cmocka_unit_test(what_four_readings_say),
        cmocka_unit_test(equal_readings_with_sigma),
        cmocka_unit_test(ranges_at_a_late_clock),
        cmocka_unit_test(noisy_sets),
        cmocka_unit_test(pulses_are_seen),
        cmocka_unit_test(laws_across_tests),
        cmocka_unit_test(laws_reach_the_deck),
        cmocka_unit_test(laws_refuse),
        cmocka_unit_test(overflow),
        cmocka_unit_test(table_3),
        cmocka_unit_test(averages_with_flags),
        cmocka_unit_test(polynomials),
        cmocka_unit_test(deck_area),
        cmocka_unit_test(any_numbers),
        cmocka_unit_test(texts),
    };
    if (getenv("RIDDLE_TEST")) cmocka_set_test_filter(getenv("RIDDLE_TEST"));
    return cmocka_run_group_tests(tests, NULL, NULL);
}
