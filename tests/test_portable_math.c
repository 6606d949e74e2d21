/* The portable functions against the C library's long double, and their bits against a fixed hash: the same on
   every machine. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <stdio.h>

#include "../base/portable_math.h"

typedef double (*function)(double);
typedef long double (*true_function)(long double);

/* Deviation in units of the last place of the true value. */
static double ulps(double value, long double truth) {
    int exponent;
    if (truth == 0.0L) return fabs(value) / DBL_MIN;
    frexpl(truth, &exponent);
    if (exponent < -1021) exponent = -1021;
    return (double)(fabsl((long double)value - truth) / ldexpl(1.0L, exponent - 53));
}

static double worst_ulps(function f, true_function truth, double low, double high, int n, int logarithmic) {
    double worst = 0.0;
    for (int i = 0; i <= n; i++) {
        double s = (double)i / n,
               x = logarithmic ? pow(10.0, log10(low) + s * (log10(high) - log10(low))) : low + (high - low) * s;
        double e = ulps(f(x), truth((long double)x));
        if (!(e <= worst)) worst = e;
    }
    return worst;
}

static double worst_absolute(function f, true_function truth, double low, double high, int n) {
    double worst = 0.0;
    for (int i = 0; i <= n; i++) {
        double x = low + (high - low) * i / n, e = (double)fabsl((long double)f(x) - truth((long double)x));
        if (!(e <= worst)) worst = e;
    }
    return worst;
}

static void expect_at_most(double value, double limit, const char *what) {
    printf("%s: %.3g (allowed %.3g)\n", what, value, limit);
    assert_true(value <= limit);
}

static void test_against_long_double(void **state) {
    (void)state;
    if (LDBL_MANT_DIG <= DBL_MANT_DIG) skip();
    expect_at_most(worst_ulps(riddle_exp, expl, -700.0, 709.7, 200000, 0), 4.0, "exp [ulp]");
    expect_at_most(worst_ulps(riddle_expm1, expm1l, 1e-300, 0.36, 100000, 1), 4.0, "expm1, small [ulp]");
    expect_at_most(worst_ulps(riddle_expm1, expm1l, -40.0, 700.0, 200000, 0), 4.0, "expm1 [ulp]");
    expect_at_most(worst_ulps(riddle_log, logl, 1e-307, 1e308, 200000, 1), 4.0, "log [ulp]");
    expect_at_most(worst_ulps(riddle_log, logl, 0.5, 2.0, 200000, 0), 4.0, "log near 1 [ulp]");
    expect_at_most(worst_ulps(riddle_log1p, log1pl, 1e-300, 1e3, 100000, 1), 4.0, "log1p [ulp]");
    expect_at_most(worst_ulps(riddle_log1p, log1pl, -0.99, 1.0, 200000, 0), 4.0, "log1p near 0 [ulp]");
    expect_at_most(worst_ulps(riddle_cbrt, cbrtl, 1e-307, 1e308, 200000, 1), 4.0, "cbrt [ulp]");
    expect_at_most(worst_ulps(riddle_atan, atanl, 1e-300, 1e300, 200000, 1), 4.0, "atan [ulp]");
    expect_at_most(worst_ulps(riddle_atan, atanl, -3.0, 3.0, 200000, 0), 4.0, "atan near 0 [ulp]");
    expect_at_most(worst_ulps(riddle_acos, acosl, -1.0, 0.9999, 200000, 0), 4.0, "acos [ulp]");
    expect_at_most(worst_ulps(riddle_asin, asinl, -1.0, 1.0, 200000, 0), 4.0, "asin [ulp]");
    expect_at_most(worst_absolute(riddle_sin, sinl, -10.0, 10.0, 200000), 2e-16, "sin, absolute [-]");
    expect_at_most(worst_absolute(riddle_cos, cosl, -10.0, 10.0, 200000), 2e-16, "cos, absolute [-]");
    expect_at_most(worst_absolute(riddle_sin, sinl, -1e6, 1e6, 500000), 2e-16, "sin to 1e6 rad, absolute [-]");
    expect_at_most(worst_absolute(riddle_cos, cosl, -1e6, 1e6, 500000), 2e-16, "cos to 1e6 rad, absolute [-]");
}

static void test_pow(void **state) {
    (void)state;
    if (LDBL_MANT_DIG <= DBL_MANT_DIG) skip();
    double worst = 0.0;
    for (int i = 1; i <= 300; i++)
        for (int k = -100; k <= 100; k++) {
            double x = pow(10.0, (i - 150) / 50.0), y = k / 10.0, size = fabs(y * log(x));
            long double truth = powl((long double)x, (long double)y);
            double e = (double)fabsl((long double)riddle_pow(x, y) / truth - 1.0L) / (DBL_EPSILON * (2.0 + size));
            if (!(e <= worst)) worst = e;
        }
    expect_at_most(worst, 1.0, "pow, relative [(2 + |y log x|) * 2.2e-16]");
    assert_true(riddle_pow(0.0, 0.0) == 1.0 && riddle_pow(0.0, 2.0) == 0.0 && riddle_pow(5.0, 0.0) == 1.0 &&
                riddle_pow(1.0, 1e300) == 1.0);
}

static void test_atan2(void **state) {
    (void)state;
    double worst = 0.0;
    for (int i = 0; i < 100000; i++) {
        double angle = -3.14159 + 6.28318 * i / 100000, x = cos(angle), y = sin(angle);
        double e = fabs(riddle_atan2(y, x) - atan2(y, x));
        if (!(e <= worst)) worst = e;
    }
    expect_at_most(worst, 1e-15, "atan2, absolute [rad]");
    assert_true(riddle_atan2(0.0, -1.0) == RIDDLE_PI && riddle_atan2(1.0, 0.0) == RIDDLE_PI / 2 &&
                riddle_atan2(0.0, 0.0) == 0.0);
}

static void test_edges(void **state) {
    (void)state;
    double nan = (double)NAN, inf = HUGE_VAL;
    assert_true(riddle_exp(0.0) == 1.0 && riddle_exp(-inf) == 0.0 && riddle_exp(-1e308) == 0.0 &&
                riddle_exp(inf) == inf);
    assert_true(riddle_exp(709.0) < inf && riddle_exp(710.0) == inf && riddle_exp(-744.0) > 0.0);
    assert_true(riddle_log(1.0) == 0.0 && riddle_log(0.0) == -inf && riddle_log(inf) == inf);
    assert_true(fabs(riddle_log(4.9e-324) + 744.44007192138122) < 1e-12);
    assert_true(riddle_expm1(0.0) == 0.0 && riddle_log1p(0.0) == 0.0 && riddle_cbrt(0.0) == 0.0 &&
                riddle_sin(0.0) == 0.0 && riddle_cos(0.0) == 1.0);
    assert_true(riddle_cbrt(-27.0) == -3.0 && riddle_cbrt(8.0) == 2.0 && riddle_cbrt(inf) == inf &&
                riddle_atan(inf) == RIDDLE_PI / 2);
    assert_true(riddle_acos(1.0) == 0.0 && riddle_acos(-1.0) == RIDDLE_PI && riddle_asin(1.0) == RIDDLE_PI / 2);
    double outside[] = {riddle_log(-1e-300),    riddle_log1p(-1.5), riddle_acos(1.0000001), riddle_asin(-1.1),
                        riddle_sin(1.1e6),      riddle_cos(-inf),   riddle_pow(-1.0, 0.5),  riddle_exp(nan),
                        riddle_expm1(nan),      riddle_log(nan),    riddle_log1p(nan),      riddle_cbrt(nan),
                        riddle_sin(nan),        riddle_cos(nan),    riddle_atan(nan),       riddle_atan2(nan, 1.0),
                        riddle_atan2(1.0, nan), riddle_acos(nan),   riddle_pow(nan, 2.0),   riddle_pow(2.0, nan)};
    for (int i = 0; i < (int)(sizeof outside / sizeof *outside); i++)
        if (outside[i] == outside[i]) fail_msg("case %d is not NaN", i);
}

static uint64_t mixed(uint64_t hash, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (hash ^ bits) * 0x100000001b3u;
}

/* Inputs made of + - * / only, outputs hashed bit by bit (FNV-1a, a word at a time). */
static void test_same_bits_everywhere(void **state) {
    (void)state;
    uint64_t hash = 0xcbf29ce484222325u;
    double x = 0.3;
    for (int i = 0; i < 100000; i++) {
        x = 3.99 * x * (1.0 - x); /* in (0, 1), wandering */
        double wide = (x - 0.5) * 1400.0, positive = x / (1.0 - 0.999999 * x);
        hash = mixed(hash, riddle_exp(wide));
        hash = mixed(hash, riddle_expm1(wide * 1e-3));
        hash = mixed(hash, riddle_log(positive));
        hash = mixed(hash, riddle_log1p(x - 0.5));
        hash = mixed(hash, riddle_pow(positive, wide * 1e-2));
        hash = mixed(hash, riddle_cbrt(wide));
        hash = mixed(hash, riddle_sin(wide * 100.0));
        hash = mixed(hash, riddle_cos(wide));
        hash = mixed(hash, riddle_atan(wide * 1e-2));
        hash = mixed(hash, riddle_atan2(wide, positive - 1.0));
        hash = mixed(hash, riddle_acos(2.0 * x - 1.0));
        hash = mixed(hash, riddle_asin(2.0 * x - 1.0));
    }
    printf("hash %016llx\n", (unsigned long long)hash);
    assert_true(hash == 0x4e0e312755ac983cu);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_long_double),
        cmocka_unit_test(test_pow),
        cmocka_unit_test(test_atan2),
        cmocka_unit_test(test_edges),
        cmocka_unit_test(test_same_bits_everywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
