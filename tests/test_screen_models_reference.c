/* screen_models.h against slow, plain calculations of the same things: model 3 by small steps of the paper's own scheme
   and by Runge-Kutta, derivatives by differences, the fitter by a random search; and its bits against a hash that holds
   for every compiler and level. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "screen_models.h"

static const double diameters[] = {0.005, 0.007};

static screen_def batch(void) {
    screen_def def = screen_default_def();
    def.classes = 2;
    def.diameters = diameters;
    def.ratio = SCREEN_RATIO_RETAINED;
    return def;
}

/* ---- model 3, eqs 36-43 as they stand ---------------------------------------------------------------------------- */

typedef struct plain {
    double w[2], b[2], s_inf[2], s[2], bottom[2], y[2];
} plain;

static void plain_rates(const screen_def *def, const plain *m, double *c) {
    double m_0 = def->undersize_mass, coarse = def->oversize_mass, left = 0.0, grains = 0.0, volume[2];
    for (int i = 0; i < 2; i++) {
        volume[i] = pow(def->diameters[i], 3.0);
        left += m_0 * (m->s_inf[i] - m->s[i]);
        grains += m_0 * (m->s_inf[i] - m->s[i]) / volume[i];
    }
    double q = left / (coarse + left), top = coarse + left,
           v_av = top / (grains + coarse / pow(def->coarse_diameter, 3.0));
    double h_t = top / (def->deck_area * def->bulk_density);
    for (int i = 0; i < 2; i++)
        c[i] = m->w[i] * exp(-pow(2.0 * q, 5.0)) * exp(-2.5 * volume[i] / v_av) / (h_t / def->coarse_diameter);
}

static void plain_slope(const screen_def *def, const plain *m, plain *d) {
    double c[2], bottom = m->bottom[0] + m->bottom[1];
    plain_rates(def, m, c);
    for (int i = 0; i < 2; i++) {
        double out = m->b[i] * m->y[i] * m->bottom[i];
        if (bottom > def->bottom_limit) out *= def->bottom_limit / bottom;
        d->s[i] = c[i] * (m->s_inf[i] - m->s[i]);
        d->bottom[i] = d->s[i] - out;
        d->y[i] = -out;
    }
}

static plain plain_along(plain m, const plain *d, double h) {
    for (int i = 0; i < 2; i++) {
        m.s[i] += h * d->s[i];
        m.bottom[i] += h * d->bottom[i];
        m.y[i] += h * d->y[i];
    }
    return m;
}

/* Classical Runge-Kutta on S, B, Y: right where c h is small. */
static plain plain_run(const screen_def *def, plain m, double end, int steps) {
    double h = end / steps;
    for (int k = 0; k < steps; k++) {
        plain a, b, c, d, at;
        plain_slope(def, &m, &a);
        at = plain_along(m, &a, 0.5 * h);
        plain_slope(def, &at, &b);
        at = plain_along(m, &b, 0.5 * h);
        plain_slope(def, &at, &c);
        at = plain_along(m, &c, h);
        plain_slope(def, &at, &d);
        m = plain_along(plain_along(plain_along(plain_along(m, &a, h / 6.0), &b, h / 3.0), &c, h / 3.0), &d, h / 6.0);
    }
    return m;
}

static plain plain_start(const double *p, const screen_operation *o) {
    plain m;
    for (int i = 0; i < 2; i++) {
        double x = o->amplitude * o->frequency / sqrt(diameters[i] * 9.81), dry = 1.0 - o->moisture;
        m.w[i] = p[0] * pow(x * pow(dry, p[2]) / (diameters[i] / 0.006), p[1]);
        m.b[i] = p[3] * pow(x * pow(dry, p[5]) / (diameters[i] / 0.008), p[4]);
        m.s_inf[i] = m.y[i] = 0.5;
        m.s[i] = m.bottom[i] = 0.0;
    }
    return m;
}

static const double sets[][6] = {
    {0.05, -0.8, 2.0, 1.0, 0.5, 1.0}, /* slow stratification */
    {3.0, -1.5, 1.0, 4.0, -0.5, 2.0}, /* both of a kind */
    {40.0, 0.3, 5.0, 60.0, 0.1, 3.0}, /* fast passage */
    {2.0, -2.0, 0.0, 0.05, 1.0, 0.0}, /* slow passage */
};

static void the_integrator_meets_runge_kutta(void **state) {
    (void)state;
    screen_def def = batch();
    screen_operation operations[] = {{0.001, 50.6, 0.0, 0.0}, {0.0012, 45.8, 0.05, 0.0}};
    double worst = 0.0;
    for (int limited = 0; limited < 2; limited++)
        for (size_t k = 0; k < sizeof sets / sizeof sets[0]; k++)
            for (int o = 0; o < 2; o++)
                for (double end = 0.5; end < 9.0; end *= 4.0) {
                    double y[2], s[2], b[2];
                    def.bottom_limit = limited ? 0.15 : HUGE_VAL;
                    plain m = plain_run(&def, plain_start(sets[k], &operations[o]), end, 40000);
                    assert_int_equal(screen_predict(&def, SCREEN_SOLDINGER, sets[k], &operations[o], 1, &end, y, s, b),
                                     SCREEN_OK);
                    for (int i = 0; i < 2; i++) {
                        double off = fabs(y[i] - m.y[i] / 0.5);
                        worst = off > worst ? off : worst;
                        if (off > (limited ? 3e-7 : 2e-8))
                            fail_msg("set %d, %g s: Y %.12g, Runge-Kutta %.12g", (int)k, end, y[i], m.y[i] / 0.5);
                        if (fabs(s[i] - m.s[i] / 0.5) > 3e-6)
                            fail_msg("set %d, %g s: S %.12g, Runge-Kutta %.12g", (int)k, end, s[i], m.s[i] / 0.5);
                    }
                }
    print_message("worst against Runge-Kutta: %.1e\n", worst);
}

/* The tolerance is kept, and fixed steps converge with order 2. */
static void errors_follow_tolerance_and_step(void **state) {
    (void)state;
    screen_def def = batch();
    screen_operation initial = {0.001, 50.6, 0.0, 0.0};
    double time[] = {1.0, 5.0, 20.0}, exact[6], y[6];
    for (size_t k = 0; k < sizeof sets / sizeof sets[0]; k++) {
        def.fixed_step = 0.0;
        def.tolerance = 1e-13;
        assert_int_equal(screen_predict(&def, SCREEN_SOLDINGER, sets[k], &initial, 3, time, exact, NULL, NULL),
                         SCREEN_OK);
        for (double tolerance = 1e-4; tolerance > 1e-11; tolerance *= 0.1) {
            def.tolerance = tolerance;
            assert_int_equal(screen_predict(&def, SCREEN_SOLDINGER, sets[k], &initial, 3, time, y, NULL, NULL),
                             SCREEN_OK);
            for (int i = 0; i < 6; i++)
                if (fabs(y[i] - exact[i]) > 20.0 * tolerance)
                    fail_msg("set %d, tolerance %g: off by %g", (int)k, tolerance, y[i] - exact[i]);
        }
        double before = 0.0;
        for (int n = 4000; n <= 16000; n *= 2) {
            double error = 0.0;
            def.fixed_step = 20.0 / n;
            assert_int_equal(screen_predict(&def, SCREEN_SOLDINGER, sets[k], &initial, 3, time, y, NULL, NULL),
                             SCREEN_OK);
            for (int i = 0; i < 6; i++) error = fabs(y[i] - exact[i]) > error ? fabs(y[i] - exact[i]) : error;
            if (n > 4000 && !(error < before / 3.4 && error > before / 4.6))
                fail_msg("set %d: %g after %g is not order 2", (int)k, error, before);
            before = error;
        }
    }
    /* published parameters: adaptive against ten times finer, and the paper's explicit step, which needs c dt < 1 */
    double p[6];
    screen_published(SCREEN_SOLDINGER, p);
    def = batch();
    def.tolerance = 1e-13;
    assert_int_equal(screen_predict(&def, SCREEN_SOLDINGER, p, &initial, 3, time, exact, NULL, NULL), SCREEN_OK);
    def.tolerance = 1e-9;
    assert_int_equal(screen_predict(&def, SCREEN_SOLDINGER, p, &initial, 3, time, y, NULL, NULL), SCREEN_OK);
    for (int i = 0; i < 6; i++) assert_true(fabs(y[i] - exact[i]) < 1e-8);
    plain m = plain_start(p, &initial), d;
    double c[2], largest = 0.0;
    plain_rates(&def, &m, c);
    assert_true(m.w[0] > 3e5 && m.w[1] < 3e8 && c[0] > 1e3 && c[1] < 2e4); /* what the specification says of them */
    for (int k = 0; k < 40; k++) {                                         /* explicit Euler, dt = 0.5 s */
        plain_slope(&def, &m, &d);
        m = plain_along(m, &d, 0.5);
        largest = fabs(m.s[0]) > largest ? fabs(m.s[0]) : largest;
    }
    assert_true(!(largest < 100.0)); /* it diverges */
}

/* ---- fit --------------------------------------------------------------------------------------------------------- */

enum { CASES = 8, TIMES = 20, POINTS = 40 };
static double time_axis[TIMES], curves[CASES][POINTS];

static void make_cases(const screen_def *def, screen_model model, const double *p, screen_case *cases, double noise) {
    uint64_t random = 11;
    for (int j = 0; j < TIMES; j++) time_axis[j] = 1.0 * (j + 1);
    for (int k = 0; k < CASES; k++) {
        screen_operation operation = {0.0008 + 0.0004 * (k & 1), 45.8 + 9.6 * (k >> 1 & 1), 0.05 * (k >> 2), 0.0};
        cases[k].operation = operation;
        cases[k].times = TIMES;
        cases[k].time = time_axis;
        cases[k].retained = curves[k];
        assert_int_equal(screen_predict(def, model, p, &operation, TIMES, time_axis, curves[k], NULL, NULL), SCREEN_OK);
        for (int j = 0; j < POINTS; j++) curves[k][j] += noise * screen__normal(&random);
    }
}

static void derivatives_meet_differences(void **state) {
    (void)state;
    screen_def def = batch();
    const double p[4][6] = {{1.3, 1.7, 3.0, 0, 0, 0},
                            {500.0, 0.4, 2.0, 0, 0, 0},
                            {1.3883, 0.8288, 2.2026, 0.0542, -5.5913, 0.4581},
                            {3.0, -1.5, 1.0, 4.0, -0.5, 2.0}};
    screen_case cases[CASES];
    for (int limited = 0; limited < 2; limited++)
        for (int m = 0; m < 4; m++) {
            screen__problem problem;
            screen__sums at, plus, minus;
            double c[6], q[6], moved[6], size = 0.0;
            def.bottom_limit = limited ? 0.1 : HUGE_VAL;
            make_cases(&def, (screen_model)m, p[m], cases, 0.03);
            screen_fit_options options = screen_default_fit_options((screen_model)m);
            assert_int_equal(screen__pose(&problem, &def, (screen_model)m, CASES, cases, &options), SCREEN_OK);
            problem.def.tolerance = 1e-11;
            for (int j = 0; j < problem.parameters; j++) q[j] = screen__to_q((screen_model)m, j, p[m][j]);
            screen__to_coefficients((screen_model)m, problem.parameters, problem.centre, q, c);
            screen__evaluate(&problem, c, 0.05, 1, 1, &at);
            for (int j = 0; j < problem.parameters; j++)
                size = fabs(at.gradient[j]) > size ? fabs(at.gradient[j]) : size;
            for (int j = 0; j < problem.parameters; j++) {
                memcpy(moved, c, sizeof c);
                moved[j] = c[j] + 1e-4;
                screen__evaluate(&problem, moved, 0.05, 0, 1, &plus);
                moved[j] = c[j] - 1e-4;
                screen__evaluate(&problem, moved, 0.05, 0, 1, &minus);
                double wanted = (plus.loss - minus.loss) / 2e-4;
                if (fabs(at.gradient[j] - wanted) > (m == 3 ? 3e-3 : 1e-6) * size)
                    fail_msg("model %d, coefficient %d: %.9g, differences %.9g", m, j, at.gradient[j], wanted);
            }
            screen__dispose(&problem);
        }
}

/* 20 000 random sets and shrinking steps from the best find nothing better. */
static void a_random_search_finds_nothing_better(void **state) {
    (void)state;
    screen_def def = batch();
    const double p[] = {1.3883, 0.8288, 2.2026, 0.0542, -5.5913, 0.4581};
    screen_case cases[CASES];
    for (int m = 0; m < 3; m++) {
        make_cases(&def, SCREEN_SUBASINGHE, p, cases, 0.01);
        screen_fit_options options = screen_default_fit_options((screen_model)m);
        screen_fit_result fit;
        options.data_tolerance = 0.2;
        assert_int_equal(screen_fit(&def, (screen_model)m, CASES, cases, &options, &fit), SCREEN_OK);
        screen__problem problem;
        screen__sums sums;
        assert_int_equal(screen__pose(&problem, &def, (screen_model)m, CASES, cases, &options), SCREEN_OK);
        double best[6] = {0.0}, trial[6], least = HUGE_VAL, spread = 1.0;
        uint64_t random = 99;
        for (int k = 0; k < 20000; k++) {
            for (int j = 0; j < problem.parameters; j++) {
                int wet = screen__is_wet((screen_model)m, j), rate = screen__is_rate((screen_model)m, j);
                trial[j] = k < 5000 ? (wet ? 20.0 : 12.0) * (screen__uniform(&random) - 0.5) +
                                          (rate ? (m == 1 ? 6.0 : 0.0) : 0.0)
                                    : best[j] + spread * (wet ? 3.0 : 1.0) * screen__normal(&random);
            }
            screen__evaluate(&problem, trial, 0.0, 0, 1, &sums);
            if (sums.deviation < least) {
                least = sums.deviation;
                memcpy(best, trial, sizeof best);
            }
            if (k >= 5000) spread *= 0.9994;
        }
        screen__dispose(&problem);
        print_message("model %d: fit %.8f, search %.8f\n", m, fit.deviation, least);
        assert_true(fit.deviation <= least + 1e-7 && fit.deviation > least - 0.01);
    }
}

/* ---- bits -------------------------------------------------------------------------------------------------------- */

static void mix(uint64_t *hash, double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    for (int i = 0; i < 8; i++) {
        *hash ^= bits >> (8 * i) & 255u;
        *hash *= 1099511628211u;
    }
}

static void the_bits_are_the_same_everywhere(void **state) {
    (void)state;
    uint64_t hash = 14695981039346656037u, seed = 31;
    screen_def def = batch();
    for (int k = 0; k < 3000; k++) {
        double p = screen__uniform(&seed), n = 1000.0 * screen__uniform(&seed);
        mix(&hash, screen_dong(p, n));
        mix(&hash, screen_subasinghe(p, 0.01 * n, 5.0 * p));
        mix(&hash, screen_rate(p, 9.0 * p, 3.0, 0.001, 50.0, 0.1 * p, 0.005, 0.9, 9.81));
    }
    screen_operation initial = {0.001, 50.6, 0.025, 0.0};
    screen_case cases[CASES];
    for (int m = 1; m < 4; m++) {
        double p[6], time[] = {0.5, 5.0, 20.0}, y[6], s[6], b[6], drawn[12];
        screen_published((screen_model)m, p);
        assert_int_equal(screen_predict(&def, (screen_model)m, p, &initial, 3, time, y, s, b), SCREEN_OK);
        for (int i = 0; i < 6; i++) mix(&hash, y[i] + 3.0 * s[i] + 7.0 * b[i]);
        make_cases(&def, (screen_model)m, p, cases, 0.01);
        screen_fit_options options = screen_default_fit_options((screen_model)m);
        screen_fit_result fit;
        options.data_tolerance = 0.2;
        options.starts = m == 3 ? 1 : 3;
        options.iterations = m == 3 ? 20 : 200;
        assert_int_equal(screen_fit(&def, (screen_model)m, CASES, cases, &options, &fit), SCREEN_OK);
        assert_int_equal(screen_sample(&fit, &options, 5, 2, drawn), SCREEN_OK);
        for (int j = 0; j < fit.parameters; j++) {
            mix(&hash, fit.parameter[j]);
            mix(&hash, fit.error[j]);
            mix(&hash, drawn[6 + j]);
        }
        mix(&hash, fit.deviation);
    }
    print_message("hash %016llx\n", (unsigned long long)hash);
    assert_true(hash == 0x80dc531153cb2b68u);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_integrator_meets_runge_kutta), cmocka_unit_test(errors_follow_tolerance_and_step),
        cmocka_unit_test(derivatives_meet_differences),     cmocka_unit_test(a_random_search_finds_nothing_better),
        cmocka_unit_test(the_bits_are_the_same_everywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
