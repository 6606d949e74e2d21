/* blocking.h against slow, plain calculations of the same things, and its bits against a hash that holds for every
   compiler and level. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "blocking.h"
#include "../examples/common/random.h"

static double between(uint64_t *s, double low, double high) { return low + (high - low) * random_plain(s); }

/* ---- the ODE by classical Runge-Kutta with very small steps ---- */

typedef struct waves {
    double a[3], b[3]; /* k1 = a0 (1 + a1 sin(a2 t)), k2 likewise */
} waves;

static void wave_rates(void *user, double t, double *k1, double *k2) {
    const waves *w = (const waves *)user;
    *k1 = w->a[0] * (1.0 + w->a[1] * sin(w->a[2] * t));
    *k2 = w->b[0] * (1.0 + w->b[1] * cos(w->b[2] * t));
}

static double derivative(waves *w, double t, double f) {
    double k1, k2;
    wave_rates(w, t, &k1, &k2);
    return k2 * (1.0 - f) - k1 * f;
}

static void integration(void **state) {
    (void)state;
    uint64_t seed = 5;
    for (int i = 0; i < 40; i++) {
        waves w = {{between(&seed, 0.0, 0.3), random_plain(&seed), between(&seed, 0.0, 3.0)},
                   {between(&seed, 0.0, 0.3), random_plain(&seed), between(&seed, 0.0, 3.0)}};
        const double start = between(&seed, -5.0, 5.0), length = between(&seed, 0.1, 40.0);
        blocking_ode_def def = blocking_default_ode_def();
        def.f0 = random_plain(&seed);
        def.start = start;
        def.rates = wave_rates;
        def.user = &w;
        const double times[] = {start, start + 0.3 * length, start + length};
        double f[3], mean[3];
        assert_int_equal(blocking_integrate(&def, times, 3, f, mean, NULL), BLOCKING_OK);
        const int steps = 40000;
        double y = def.f0, integral = 0.0, h = length / steps;
        for (int j = 0; j < steps; j++) {
            double t = start + j * h, a = derivative(&w, t, y), b = derivative(&w, t + 0.5 * h, y + 0.5 * h * a);
            double c = derivative(&w, t + 0.5 * h, y + 0.5 * h * b), d = derivative(&w, t + h, y + h * c);
            double middle = y + h * (5.0 * a + 4.0 * b + 4.0 * c - d) / 24.0,
                   end = y + h * (a + 2.0 * b + 2.0 * c + d) / 6.0;
            integral += h * (y + 4.0 * middle + end) / 6.0;
            y = end;
            if (j + 1 == (int)(0.3 * steps)) {
                assert_true(fabs(f[1] - y) < 2e-10 && fabs(mean[1] - integral / (0.3 * length)) < 2e-10);
            }
        }
        assert_true(fabs(f[2] - y) < 2e-10 && fabs(mean[2] - integral / length) < 2e-10);
        assert_true(f[0] == def.f0 && mean[0] == def.f0);
    }
}

/* ---- least squares against a nested grid over f0, f_inf and ln k ---- */

static double sum_of_squares(const double *t, const double *f, const double *sigma, int n, double f0, double f_inf,
                             double k) {
    double sum = 0.0;
    for (int i = 0; i < n; i++) {
        double miss = (f[i] - f_inf - (f0 - f_inf) * exp(-k * t[i])) / (sigma ? sigma[i] : 1.0);
        sum += miss * miss;
    }
    return sum;
}

/* Least sum of squares of a curve alpha + beta e^(-k t), without bounds; k may be negative, and a straight
   line for k = 0. */
static double unbounded(const double *t, const double *f, const double *sigma, int n, double k) {
    double sw = 0.0, su = 0.0, sf = 0.0, suu = 0.0, suf = 0.0, sff = 0.0;
    for (int i = 0; i < n; i++) {
        double x = k < 0.0 ? t[n - 1] - t[i] : t[i] - t[0], w = sigma ? 1.0 / (sigma[i] * sigma[i]) : 1.0;
        double u = fabs(k) * (t[n - 1] - t[0]) > 1e-3 ? exp(-fabs(k) * x) : x;
        sw += w, su += w * u, sf += w * f[i], suu += w * u * u, suf += w * u * f[i], sff += w * f[i] * f[i];
    }
    double spread = suu - su * su / sw, both = suf - su * sf / sw, all = sff - sf * sf / sw;
    return spread > 1e-14 * suu ? all - both * both / spread : all;
}

static void least_squares(void **state) {
    (void)state;
    uint64_t seed = 17;
    blocking_fit_def def = blocking_default_fit_def();
    for (int trial = 0; trial < 300; trial++) {
        double t[9], f[9], sigma[9], now = trial % 2 ? 0.0 : between(&seed, 0.0, 5.0);
        double f0 = random_plain(&seed), f_inf = random_plain(&seed), k = exp(between(&seed, -5.0, 0.5)),
               noise = trial % 3 ? 0.02 : 0.2;
        int n = 4 + trial % 6;
        for (int i = 0; i < n; i++) {
            t[i] = now;
            now += between(&seed, 0.2, 20.0);
            f[i] = fmin(1.0, fmax(0.0, f_inf + (f0 - f_inf) * exp(-k * t[i]) + noise * between(&seed, -1.0, 1.0)));
            sigma[i] = between(&seed, 0.01, 0.05);
        }
        const double *s = trial % 5 == 0 ? sigma : NULL;
        blocking_fit_result fit;
        blocking_status status = blocking_fit(&def, t, f, s, (size_t)n, &fit);
        assert_true(status == BLOCKING_OK || status == BLOCKING_NON_MONOTONE || status == BLOCKING_NOT_SATURATING ||
                    status == BLOCKING_NOT_RESOLVED);
        assert_true(fit.f0 >= 0.0 && fit.f0 <= 1.0 && fit.f_inf >= 0.0 && fit.f_inf <= 1.0 && fit.k > 0.0);
        double own = sum_of_squares(t, f, s, n, fit.f0, fit.f_inf, fit.k);
        assert_true(fabs(own - fit.sse) <= 1e-12 * own + 1e-25);
        /* the search: nothing in the box is better by more than round-off */
        double best = 1e300, at[3] = {0.5, 0.5, -3.0}, width[3] = {0.5, 0.5, 7.0};
        for (int level = 0; level < 14; level++) {
            double centre[3] = {at[0], at[1], at[2]};
            int m = level == 0 ? 40 : 6;
            for (int a = 0; a <= m; a++)
                for (int b = 0; b <= m; b++)
                    for (int c = 0; c <= m; c++) {
                        double x = fmin(1.0, fmax(0.0, centre[0] + width[0] * (2.0 * a / m - 1.0)));
                        double y = fmin(1.0, fmax(0.0, centre[1] + width[1] * (2.0 * b / m - 1.0)));
                        double z = centre[2] + width[2] * (2.0 * c / m - 1.0),
                               sse = sum_of_squares(t, f, s, n, x, y, exp(z));
                        if (sse < best && exp(z) * t[n - 1] > 1e-3) {
                            best = sse;
                            at[0] = x;
                            at[1] = y;
                            at[2] = z;
                        }
                    }
            for (int j = 0; j < 3; j++) width[j] *= level == 0 ? 0.1 : 0.5;
        }
        if (!(fit.sse <= best * (1.0 + 1e-9) + 1e-20))
            fail_msg("trial %d: sse %.12g at f0 %g f_inf %g k %g, the grid has %.12g at %g %g %g", trial, fit.sse,
                     fit.f0, fit.f_inf, fit.k, best, at[0], at[1], exp(at[2]));
        /* the profile range: at its ends the sum of squares without bounds exceeds its least by student^2 s^2 */
        double least = fit.sse, ends[2] = {fit.k_lowest, fit.k_highest};
        double place = 0.0, reach = 9.0;
        for (int level = 0; level < 4; level++, reach *= 1e-2) {
            double middle = place;
            for (int i = -1000; i <= 1000; i++) {
                double x = middle + reach * i / 1000.0, sse = unbounded(t, f, s, n, sinh(x) / (t[n - 1] - t[0]));
                if (sse <= least) least = sse, place = x;
            }
        }
        double target = least + fit.student * fit.student * (s ? 1.0 : least / (n - 3));
        for (int e = 0; e < 2; e++) {
            if (!(ends[e] > 0.0 && ends[e] < 1e300) || fabs(ends[e] / fit.k - 1.0) < 1e-9) continue;
            double sse = unbounded(t, f, s, n, ends[e]);
            if (!(fabs(sse - target) < 1e-4 * target))
                fail_msg("trial %d: sse at k %g (fitted %g) is %.10g, should be %.10g", trial, ends[e], fit.k, sse,
                         target);
        }
    }
}

/* ---- three readings against bisection on r ---- */

static void three_readings(void **state) {
    (void)state;
    uint64_t seed = 23;
    for (int i = 0; i < 20000; i++) {
        double t[3] = {0.0, between(&seed, 0.1, 10.0), 0.0}, rho = between(&seed, 1.1, 9.0);
        t[2] = rho * t[1];
        double f[3] = {random_plain(&seed), random_plain(&seed), random_plain(&seed)},
               q = (f[2] - f[0]) / (f[1] - f[0]);
        blocking_estimate e;
        blocking_status status = blocking_three_point(t, f, 0.01, 1e-9, &e);
        rho = t[2] / t[1];
        if (!(q > 1.0)) assert_int_equal(status, BLOCKING_NON_MONOTONE);
        else if (!(q < rho)) assert_int_equal(status, BLOCKING_NOT_SATURATING);
        else {
            double low = 0.0, high = 1.0; /* (1 - r^rho)/(1 - r) rises with r */
            for (int j = 0; j < 200; j++) {
                double r = 0.5 * (low + high);
                if ((1.0 - pow(r, rho)) / (1.0 - r) < q) low = r;
                else high = r;
            }
            double f_inf = f[0] + (f[1] - f[0]) / (1.0 - low);
            double loss = 1e-13 * e.error_f_inf / 0.01 + 1e-12;
            assert_true(fabs(e.r - low) < 1e-9 && fabs(e.f_inf - f_inf) < loss * 1e3);
            assert_true(status == (f_inf >= 0.0 && f_inf <= 1.0 ? BLOCKING_OK : BLOCKING_OUT_OF_RANGE) ||
                        fabs(f_inf) < 1e-9 || fabs(f_inf - 1) < 1e-9);
            for (int j = 0; j < 3; j++)
                assert_true(fabs(blocking_curve(f[0], e.f_inf, e.k, t[j]) - f[j]) < 1e-9 * (1.0 + fabs(e.f_inf)));
        }
    }
}

/* ---- polynomials against normal equations in long double ---- */

static void polynomial_fit(void **state) {
    (void)state;
    enum { POINTS = 60, TERMS = 20, VARS = 3 };
    static int powers[TERMS][VARS];
    assert_int_equal(blocking_polynomial_powers(VARS, 3, &powers[0][0], TERMS), TERMS);
    uint64_t seed = 29;
    for (int trial = 0; trial < 20; trial++) {
        double x[POINTS][VARS], y[POINTS], a[TERMS], error[TERMS], work[BLOCKING_POLYNOMIAL_WORK(POINTS, TERMS)];
        long double m[TERMS][TERMS + 1], inverse[TERMS][TERMS];
        memset(m, 0, sizeof m);
        for (int i = 0; i < POINTS; i++) {
            for (int v = 0; v < VARS; v++) x[i][v] = between(&seed, -1.0, 1.0);
            y[i] = between(&seed, -1.0, 1.0);
            long double term[TERMS];
            for (int j = 0; j < TERMS; j++) {
                term[j] = 1.0L;
                for (int v = 0; v < VARS; v++)
                    for (int p = 0; p < powers[j][v]; p++) term[j] *= x[i][v];
            }
            for (int j = 0; j < TERMS; j++) {
                for (int c = 0; c < TERMS; c++) m[j][c] += term[j] * term[c];
                m[j][TERMS] += term[j] * y[i];
            }
        }
        for (int j = 0; j < TERMS; j++)
            for (int c = 0; c < TERMS; c++) inverse[j][c] = j == c;
        for (int p = 0; p < TERMS; p++) { /* Gauss-Jordan; positive definite */
            long double pivot = m[p][p];
            for (int c = 0; c <= TERMS; c++) m[p][c] /= pivot;
            for (int c = 0; c < TERMS; c++) inverse[p][c] /= pivot;
            for (int j = 0; j < TERMS; j++) {
                if (j == p) continue;
                long double factor = m[j][p];
                for (int c = 0; c <= TERMS; c++) m[j][c] -= factor * m[p][c];
                for (int c = 0; c < TERMS; c++) inverse[j][c] -= factor * inverse[p][c];
            }
        }
        blocking_polynomial_report report;
        assert_int_equal(
            blocking_polynomial_fit(&x[0][0], y, POINTS, &powers[0][0], TERMS, VARS, a, error, work, &report),
            BLOCKING_OK);
        long double sse = 0.0L;
        for (int i = 0; i < POINTS; i++) {
            long double miss = (long double)y[i] - blocking_polynomial(a, &powers[0][0], TERMS, x[i], VARS);
            sse += miss * miss;
        }
        assert_true(fabs((double)sse - report.sse) < 1e-12 * report.sse);
        for (int j = 0; j < TERMS; j++) {
            assert_true(fabs((double)m[j][TERMS] - a[j]) < 1e-12 * (1.0 + fabs(a[j])));
            double wanted = (double)sqrtl(inverse[j][j] * sse / (POINTS - TERMS));
            assert_true(fabs(error[j] - wanted) < 1e-10 * wanted);
        }
    }
}

/* ---- same bits everywhere ---- */

static void mix(uint64_t *hash, double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    if (x != x) bits = 1; /* the sign of a NaN is nobody's promise */
    for (int i = 0; i < 8; i++) {
        *hash ^= bits >> (8 * i) & 255u;
        *hash *= 1099511628211u;
    }
}

static void ramp_rates(void *user, double t, double *k1, double *k2) {
    (void)user;
    *k1 = 0.01 + 0.001 * t;
    *k2 = 0.3 / (1.0 + t);
}

static void bits(void **state) {
    (void)state;
    uint64_t hash = 14695981039346656037u, seed = 31;
    blocking_fit_def fit_def = blocking_default_fit_def();
    for (int i = 0; i < 300; i++) {
        double f0 = random_plain(&seed), f_inf = random_plain(&seed), k = 0.3 * random_plain(&seed), t[6], f[6],
               now = 0.0;
        for (int j = 0; j < 6; j++) {
            t[j] = now;
            now += 0.1 + 10.0 * random_plain(&seed);
            f[j] = 0.9 * blocking_curve(f0, f_inf, k, t[j]) + 0.1 * random_plain(&seed);
        }
        mix(&hash, blocking_time_mean(f0, f_inf, k, t[5]));
        mix(&hash, blocking_time_to(f[2], f0, f_inf, k));
        mix(&hash, blocking_time_for_exposure(t[3], f0, f_inf, k));
        mix(&hash, blocking_toss_indicator(50.0 * f0, 1e-3, 3.0 * f_inf, k, 9.81));
        for (int s = 0; s < BLOCKING_SHAPE_COUNT; s++) mix(&hash, blocking_table3((blocking_shape)s, 5.0 * f0, f_inf));
        blocking_estimate e;
        mix(&hash, (double)blocking_three_point(t, f, 0.01, BLOCKING_TOLERANCE, &e));
        mix(&hash, e.k);
        mix(&hash, e.f_inf);
        mix(&hash, e.error_k);
        blocking_fit_result fit;
        mix(&hash, (double)blocking_fit(&fit_def, t, f, NULL, 6, &fit));
        mix(&hash, fit.k);
        mix(&hash, fit.f_inf);
        mix(&hash, fit.error_f0);
        mix(&hash, fit.k_highest);
        double a[3], work[BLOCKING_POLYNOMIAL_WORK(6, 3)];
        const int powers[] = {0, 1, 2};
        mix(&hash, (double)blocking_polynomial_fit(t, f, 6, powers, 3, 1, a, NULL, work, NULL));
        for (int j = 0; j < 3; j++) mix(&hash, a[j]);
    }
    blocking_ode_def def = blocking_default_ode_def();
    def.rates = ramp_rates;
    const double times[] = {1.0, 10.0, 100.0};
    double f[3], mean[3];
    assert_int_equal(blocking_integrate(&def, times, 3, f, mean, NULL), BLOCKING_OK);
    for (int j = 0; j < 3; j++) {
        mix(&hash, f[j]);
        mix(&hash, mean[j]);
    }
    if (hash != 0xca20de8c9491eaadu) fail_msg("bits: %016llx", (unsigned long long)hash);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(integration),    cmocka_unit_test(least_squares), cmocka_unit_test(three_readings),
        cmocka_unit_test(polynomial_fit), cmocka_unit_test(bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
