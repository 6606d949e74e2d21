/* filtration.h, process level: laws against closed forms, operations against integrals by hand, evaluated curves
   against the line they were made from, stated intervals against how often they hold, bad input. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "filtration.h"
#include "../examples/common/random.h"

#define assert_close(value, expected, relative)                                                                        \
    assert_true(fabs((value) - (expected)) <= (relative)*fabs(expected) + 1e-300)

/* ---- laws ---- */

static void test_filtration_equation(void **state) {
    (void)state;
    const double dp = 1000.0, mu = 1e-3, A = 20e-4, product = 4.14e9, medium = 3.4e6;
    const double slope = filtration_slope(product, dp, mu, A), intercept = filtration_intercept(medium, dp, mu, A);
    assert_close(filtration_velocity(dp, mu, 0.0, medium), 0.29411764705882354, 1e-15);
    assert_close(filtration_resistance(dp, mu, 0.29411764705882354), medium, 1e-15);
    assert_close(slope, 5.175e8, 1e-14);
    assert_close(intercept, 1.7e3, 1e-14);
    assert_close(filtration_product_of_slope(slope, dp, mu, A), product, 1e-14);
    assert_close(filtration_medium_of_intercept(intercept, dp, mu, A), medium, 1e-14);
    assert_close(filtration_cake_resistance(7.8e10, 0.318e-3), 2.4804e7, 1e-12);
    assert_close(filtration_medium_resistance(3.4e6, 1e6), 4.4e6, 1e-15);
    /* the paper's 98 ms for 14 mL of filtrate on 20 cm2 */
    assert_close(filtration_time_of_volume(slope, intercept, 14e-6), 0.1252, 0.02);
    /* a velocity that is the derivative of the volume */
    const double V = 9e-6, t = filtration_time_of_volume(slope, intercept, V), h = 1e-6 * t;
    const double v =
        (filtration_volume_of_time(slope, intercept, t + h) - filtration_volume_of_time(slope, intercept, t - h)) /
        (2 * h * A);
    assert_close(v, filtration_velocity(dp, mu, product * V / A, medium), 1e-8);
    assert_close(filtration_pressure(product, medium, mu, v, V / A), dp, 1e-8);
}

static void test_inverse_of_time(void **state) {
    (void)state;
    for (double V = 1e-12; V < 1e3; V *= 13.0)
        for (double slope = 1e-6; slope < 1e12; slope *= 1e3) {
            assert_close(filtration_volume_of_time(slope, 2.0, filtration_time_of_volume(slope, 2.0, V)), V, 1e-14);
            assert_close(filtration_volume_of_time(slope, 0.0, filtration_time_of_volume(slope, 0.0, V)), V, 1e-14);
        }
    assert_true(filtration_volume_of_time(1.0, 1.0, 0.0) == 0.0);
}

static void test_kozeny_carman(void **state) {
    (void)state;
    /* the table of the specification, d = 80 um */
    const double e[] = {0.40, 0.42, 0.44, 0.46, 0.47, 0.48}, r[] = {1.58e11, 1.28e11, 1.04e11, 8.4e10, 7.6e10, 6.9e10};
    for (int i = 0; i < 6; i++) {
        assert_close(filtration_kozeny_carman(e[i], 80e-6, FILTRATION_KOZENY_CARMAN), r[i], 0.01);
        assert_close(filtration_kozeny_porosity(filtration_kozeny_carman(e[i], 80e-6, 180.0), 80e-6, 180.0), e[i],
                     1e-13);
    }
    for (double porosity = 1e-9; porosity < 1.0; porosity = porosity < 0.1 ? 10.0 * porosity : porosity + 0.0999)
        assert_close(filtration_kozeny_porosity(filtration_kozeny_carman(porosity, 1e-5, 150.0), 1e-5, 150.0), porosity,
                     1e-12);
    assert_true(filtration_kozeny_carman(1.0, 1e-5, 180.0) == 0.0);
}

static void test_cake_ratios(void **state) {
    (void)state;
    /* a suspension of 5 % solid makes a cake of porosity 0.45: of 1 m3, c / (1 - e) is cake, the rest filtrate */
    const double cake = 0.05 / 0.55, ratio = cake / (1.0 - cake);
    assert_close(filtration_cake_ratio(0.05, 0.45), ratio, 1e-14);
    assert_close(filtration_cake_ratio_of_solid(0.05, 0.45, 1.0 - cake), ratio, 1e-14);
    assert_close(filtration_cake_ratio_of_height(cake / 0.1, 0.1, 1.0 - cake), ratio, 1e-14);
    assert_close(filtration_mass_resistance(7.8e10, 0.479, 2200.0), 7.8e10 / (2200.0 * 0.521), 1e-14);
    assert_true(filtration_cake_ratio(0.0, 0.4) == 0.0);
}

/* The mean of a cake in layers against the closed forms. */
static void test_compressible_means(void **state) {
    (void)state;
    const double n = 0.4, beta = 0.12, p = 3e5, p1 = 1e5, a1 = 1e11, c1 = 0.3;
    const int layers = 400000;
    double solid = 0.0, height = 0.0; /* per pressure: d(solid) = dp / a, d(height) = dp / (a c) */
    for (int i = 0; i < layers; i++) {
        const double s = (i + 0.5) / layers, at = p * s * s * s * s,
                     step = 4.0 * p * s * s * s / layers; /* fine near 0 */
        const double a = filtration_power_law(a1, n, at, p1), c = filtration_power_law(c1, beta, at, p1);
        solid += step / a;
        height += step / (a * c);
    }
    assert_close(p / solid, filtration_mean_of_local(filtration_power_law(a1, n, p, p1), n), 1e-6);
    assert_close(solid / height, filtration_mean_solid(filtration_power_law(c1, beta, p, p1), n, beta), 1e-6);
    assert_close(filtration_power_law(2.0, 0.5, 4.0, 1.0), 4.0, 1e-14);
}

static void test_student(void **state) {
    (void)state;
    const double pi = 3.14159265358979323846, confidence[] = {1e-6, 0.05, 0.5, 0.9, 0.95, 0.99, 0.9999};
    for (int i = 0; i < 7; i++) {
        const double c = confidence[i];
        assert_close(filtration_student(c, 1.0), tan(0.5 * pi * c), 1e-9);
        assert_close(filtration_student(c, 2.0), c * sqrt(2.0 / ((1.0 - c) * (1.0 + c))), 1e-9);
    }
    assert_close(filtration_student(0.95, 5.0), 2.570581835636314, 1e-9);
    assert_close(filtration_student(0.95, 10.0), 2.2281388519649385, 1e-9);
    assert_close(filtration_student(0.99, 30.0), 2.7499956535672, 1e-9);
    assert_close(filtration_student(0.95, 1e12), 1.959963984540054, 1e-7);
    assert_close(filtration_student(0.999, 2.0), 31.599054576443623, 1e-9);
    assert_true(isnan(filtration_student(1.0, 3.0)) && isnan(filtration_student(0.0, 3.0)));
    assert_true(isnan(filtration_student(0.9, 0.0)) && isnan(filtration_student(NAN, 2.0)) &&
                isnan(filtration_student(0.9, NAN)));
    double before = HUGE_VAL; /* falls with the degrees of freedom, whole or not */
    for (double freedom = 0.3; freedom < 1e6; freedom *= 1.7) {
        const double t = filtration_student(0.95, freedom);
        assert_true(t < before && t > 1.9599);
        before = t;
    }
}

static void test_laws_out_of_domain(void **state) {
    (void)state;
    const double bad[] = {NAN, -1.0, -HUGE_VAL};
    for (int i = 0; i < 3; i++) {
        const double b = bad[i];
        assert_true(isnan(filtration_velocity(b, 1, 1, 1)) && isnan(filtration_velocity(1, b, 1, 1)));
        assert_true(isnan(filtration_velocity(1, 1, b, 1)) && isnan(filtration_velocity(1, 1, 1, b)));
        assert_true(isnan(filtration_resistance(b, 1, 1)) && isnan(filtration_resistance(1, b, 1)) &&
                    isnan(filtration_resistance(1, 1, b)));
        assert_true(isnan(filtration_cake_resistance(b, 1)) && isnan(filtration_cake_resistance(1, b)));
        assert_true(isnan(filtration_medium_resistance(b, 1)) && isnan(filtration_medium_resistance(1, b)));
        assert_true(isnan(filtration_slope(b, 1, 1, 1)) && isnan(filtration_slope(1, b, 1, 1)) &&
                    isnan(filtration_slope(1, 1, b, 1)));
        assert_true(isnan(filtration_slope(1, 1, 1, b)) && isnan(filtration_intercept(b, 1, 1, 1)) &&
                    isnan(filtration_intercept(1, 1, 1, b)));
        assert_true(isnan(filtration_product_of_slope(1, b, 1, 1)) &&
                    isnan(filtration_medium_of_intercept(1, 1, b, 1)));
        assert_true(isnan(filtration_time_of_volume(b, 1, 1)) && isnan(filtration_time_of_volume(1, 1, b)));
        assert_true(isnan(filtration_volume_of_time(1, b, 1)) && isnan(filtration_volume_of_time(1, 1, b)));
        assert_true(isnan(filtration_pressure(b, 1, 1, 1, 1)) && isnan(filtration_pressure(1, 1, 1, 1, b)));
        assert_true(isnan(filtration_power_law(b, 1, 1, 1)) && isnan(filtration_power_law(1, 1, b, 1)) &&
                    isnan(filtration_power_law(1, 1, 1, b)));
        assert_true(isnan(filtration_mean_of_local(1, b)) && isnan(filtration_mean_solid(b, 0, 0)) &&
                    isnan(filtration_mean_solid(0.5, 0, b)));
        assert_true(isnan(filtration_kozeny_carman(b, 1, 1)) && isnan(filtration_kozeny_carman(0.4, b, 1)) &&
                    isnan(filtration_kozeny_carman(0.4, 1, b)));
        assert_true(isnan(filtration_kozeny_porosity(b, 1, 1)) && isnan(filtration_kozeny_porosity(1, b, 1)));
        assert_true(isnan(filtration_cake_ratio(b, 0.1)) && isnan(filtration_cake_ratio(0.1, b)));
        assert_true(isnan(filtration_cake_ratio_of_solid(b, 0.4, 1)) &&
                    isnan(filtration_cake_ratio_of_height(1, b, 1)));
        assert_true(isnan(filtration_mass_resistance(1, 0.4, b)));
    }
    assert_true(isnan(filtration_velocity(1, 1, 0, 0)) && isnan(filtration_volume_of_time(0, 0, 1)));
    assert_true(isnan(filtration_mean_of_local(1, 1.0)) && isnan(filtration_mean_solid(0.5, 0.6, 0.4)));
    assert_true(isnan(filtration_kozeny_carman(0.0, 1, 1)) && isnan(filtration_kozeny_carman(1.01, 1, 1)));
    assert_true(isnan(filtration_cake_ratio(0.5, 0.5)) && isnan(filtration_kozeny_porosity(1e300, 1e300, 1e-300)));
    assert_true(isnan(filtration_power_law(1, NAN, 1, 1)) && isnan(filtration_kozeny_porosity(HUGE_VAL, 1, 1)));
}

static void test_settling_laws(void **state) {
    (void)state;
    assert_close(filtration_stokes_velocity(1200.0, 9.81, 80e-6, 1e-3), 4.1856e-3, 1e-12);
    /* Schiller and Naumann: 3.921 mm/s for the paper's sphere (specification, section 4) */
    double v = 4e-3;
    for (int i = 0; i < 100; i++) v = 4.1856e-3 / filtration_schiller_naumann(v * 80e-6 * 1000.0 / 1e-3);
    assert_close(v, 3.921e-3, 2e-4);
    /* Haberman and Sayre 1.350, 1.979, 5.87; Faxen 1.349, 1.977, 5.57; Ladenburg 1.263, 1.526, 2.052 */
    const double ratio[] = {0.125, 0.25, 0.5}, hs[] = {1.350, 1.979, 5.87}, faxen[] = {1.349, 1.977, 5.57},
                 first[] = {1.263, 1.526, 2.052};
    for (int i = 0; i < 3; i++) {
        assert_close(filtration_wall_haberman_sayre(ratio[i]), hs[i], 4e-4);
        assert_close(filtration_wall_faxen(ratio[i]), faxen[i], 4e-4);
        assert_close(filtration_wall_ladenburg(ratio[i]), first[i], 1e-4);
    }
    /* Brenner's table: gap over radius cosh(alpha) - 1, alpha 0.5, 1, 1.5, 2, 3 */
    const double alpha[] = {0.5, 1.0, 1.5, 2.0, 3.0}, drag[] = {9.2518, 3.0361, 1.8375, 1.4129, 1.1252};
    for (int i = 0; i < 5; i++) assert_close(filtration_wall_brenner(cosh(alpha[i]) - 1.0), drag[i], 5e-5);
    assert_close(filtration_wall_brenner(0.999e-3), filtration_wall_brenner(1.001e-3),
                 2.1e-3); /* the series joins the lubrication */
    assert_close(filtration_wall_brenner(1e8), 1.0, 1e-7);
    double before = HUGE_VAL;
    for (double gap = 1e-9; gap < 1e9; gap *= 1.3) {
        assert_true(filtration_wall_brenner(gap) < before && filtration_wall_brenner(gap) > 1.0);
        before = filtration_wall_brenner(gap);
    }
    assert_true(isnan(filtration_wall_brenner(0.0)) && isnan(filtration_wall_brenner(NAN)) &&
                isnan(filtration_schiller_naumann(-1.0)));
    assert_true(isnan(filtration_schiller_naumann(1001.0)) && isnan(filtration_wall_ladenburg(1.0)) &&
                isnan(filtration_wall_faxen(-0.1)));
    assert_true(isnan(filtration_wall_haberman_sayre(0.8)) && isnan(filtration_stokes_velocity(1, 1, 0.0, 1)));
}

/* ---- size distributions ---- */

static void test_number_shares(void **state) {
    (void)state;
    /* the paper's classes; number shares of the specification to volume shares and back */
    const double d[] = {55e-6, 63e-6, 72e-6, 83e-6, 95e-6, 109e-6}, number[] = {.030, .119, .327, .379, .135, .010};
    double volume[6], back[6], sum = 0.0;
    assert_int_equal(filtration_convert_shares(6, d, number, 3.0, volume), FILTRATION_OK);
    assert_int_equal(filtration_convert_shares(6, d, volume, -3.0, back), FILTRATION_OK);
    for (int i = 0; i < 6; i++) assert_close(back[i], number[i], 1e-13);
    for (int i = 0; i < 6; i++) sum += volume[i];
    assert_close(sum, 1.0, 1e-14);
    double cube = 0.0, square = 0.0;
    for (int i = 0; i < 6; i++) cube += number[i] * d[i] * d[i] * d[i], square += number[i] * d[i] * d[i];
    assert_close(filtration_sauter(6, d, volume), cube / square, 1e-13);
    memcpy(back, volume, sizeof back); /* in place */
    assert_int_equal(filtration_convert_shares(6, d, back, -3.0, back), FILTRATION_OK);
    assert_close(back[3], number[3], 1e-13);
}

static void test_number_distribution(void **state) {
    (void)state;
    /* Q3 = ((x - a) / (b - a)): Q0 = (a^-2 - x^-2) / (a^-2 - b^-2), whatever the steps */
    const double a = 2e-5, b = 9e-5;
    double x[7] = {2e-5, 2.1e-5, 3e-5, 4.7e-5, 5e-5, 8e-5, 9e-5}, Q3[7], Q0[7];
    for (int i = 0; i < 7; i++) Q3[i] = (x[i] - a) / (b - a);
    assert_int_equal(filtration_number_distribution(7, x, Q3, Q0), FILTRATION_OK);
    for (int i = 1; i < 7; i++)
        assert_close(Q0[i], (1 / (a * a) - 1 / (x[i] * x[i])) / (1 / (a * a) - 1 / (b * b)), 1e-13);
    assert_true(Q0[0] == 0.0 && Q0[6] == 1.0);
    assert_int_equal(filtration_number_distribution(7, x, Q3, Q3), FILTRATION_OK); /* in place */
    for (int i = 0; i < 7; i++) assert_true(Q3[i] == Q0[i]);
}

static void test_bad_distributions(void **state) {
    (void)state;
    double d[3] = {1e-6, 2e-6, 3e-6}, q[3] = {0.2, 0.5, 0.3}, Q[3] = {0.0, 0.4, 1.0}, out[3];
    assert_int_equal(filtration_convert_shares(0, d, q, 3, out), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_convert_shares(3, NULL, q, 3, out), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_convert_shares(3, d, q, NAN, out), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_number_distribution(1, d, Q, out), FILTRATION_BAD_ARGUMENT);
    assert_true(isnan(filtration_sauter(0, d, q)) && isnan(filtration_sauter(3, NULL, q)));
    const double bad[] = {NAN, -1e-300, HUGE_VAL, 0.0};
    for (int i = 0; i < 4; i++) {
        double wrong[3] = {1e-6, bad[i], 3e-6};
        assert_int_equal(filtration_convert_shares(3, wrong, q, -3, out), FILTRATION_BAD_ARGUMENT);
        assert_int_equal(filtration_number_distribution(3, wrong, Q, out), FILTRATION_BAD_ARGUMENT);
        wrong[1] = bad[i];
        if (i < 3) assert_int_equal(filtration_convert_shares(3, d, wrong, -3, out), FILTRATION_BAD_ARGUMENT);
        wrong[0] = 0.0;
        if (i < 3) assert_int_equal(filtration_number_distribution(3, d, wrong, out), FILTRATION_BAD_ARGUMENT);
    }
    const double none[3] = {0, 0, 0}, from[3] = {0.1, 0.4, 1.0};
    assert_int_equal(filtration_convert_shares(3, d, none, -3, out), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_number_distribution(3, d, none, out), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_number_distribution(3, d, from, out), FILTRATION_BAD_ARGUMENT);
    const double tiny[3] = {1e-300, 2e-300, 3e-300};
    assert_int_equal(filtration_convert_shares(3, tiny, q, -3, out), FILTRATION_OK);
    assert_close(out[0], 0.2 / (0.2 + 0.5 / 8 + 0.3 / 27), 1e-12);
}

/* ---- operations ---- */

static filtration_operation an_operation(double n) {
    filtration_operation o = filtration_operation_default();
    o.area = 0.05, o.medium = 5e9, o.product = 2e12, o.compressibility = n, o.reference = 1e5, o.pressure = 3e5;
    return o;
}

static void test_constant_pressure(void **state) {
    (void)state;
    filtration_operation o = an_operation(0.0);
    filtration_point p;
    const double slope = filtration_slope(o.product, o.pressure, o.viscosity, o.area);
    const double intercept = filtration_intercept(o.medium, o.pressure, o.viscosity, o.area);
    for (double V = 1e-9; V < 10.0; V *= 7.0) {
        assert_int_equal(filtration_at_volume(&o, V, &p), FILTRATION_OK);
        assert_close(p.time, filtration_time_of_volume(slope, intercept, V), 1e-13);
        assert_close(p.flow, o.area * filtration_velocity(o.pressure, o.viscosity, o.product * V / o.area, o.medium),
                     1e-13);
        assert_close(p.cake, o.viscosity * p.flow / o.area * o.product * V / o.area, 1e-12);
        const double time = p.time;
        assert_int_equal(filtration_at_time(&o, time, &p), FILTRATION_OK);
        assert_close(p.volume, V, 1e-13);
    }
    assert_int_equal(filtration_at_volume(&o, 0.0, &p), FILTRATION_OK);
    assert_true(p.time == 0.0 && p.cake == 0.0);
    assert_close(p.flow, 0.05 * 3e5 / (1e-3 * 5e9), 1e-14);
}

static void test_constant_rate(void **state) {
    (void)state;
    filtration_operation o = an_operation(0.0);
    filtration_point p;
    o.pressure = HUGE_VAL, o.rate = 1e-4;
    assert_int_equal(filtration_change_over(&o, &p), FILTRATION_OK);
    assert_true(isinf(p.time));
    assert_int_equal(filtration_at_time(&o, 300.0, &p), FILTRATION_OK);
    assert_close(p.volume, 0.03, 1e-14);
    assert_close(p.pressure, 1e-3 * 2e-3 * (2e12 * 0.6 + 5e9), 1e-12);
    assert_close(p.cake, 1e-3 * 2e-3 * 2e12 * 0.6, 1e-12);
    o.compressibility = 0.5; /* dp_c = (mu v P_1 w)^2 / p_1 */
    assert_int_equal(filtration_at_volume(&o, 0.03, &p), FILTRATION_OK);
    assert_close(p.cake, pow(1e-3 * 2e-3 * 2e12 * 0.6, 2) / 1e5, 1e-12);
}

/* Pressure and flow join at the change-over, and time is the integral of dV / flow in both stages. */
static void test_both_in_turn(void **state) {
    (void)state;
    const double exponents[] = {0.0, 0.3, 0.7, 0.95};
    for (int k = 0; k < 4; k++)
        for (int medium = 0; medium < 2; medium++) {
            filtration_operation o = an_operation(exponents[k]);
            filtration_point change, p, q;
            if (!medium) o.medium = 0.0;
            o.rate = 1e-4;
            assert_int_equal(filtration_change_over(&o, &change), FILTRATION_OK);
            assert_true(change.volume > 0.0 && isfinite(change.volume));
            assert_int_equal(filtration_at_volume(&o, change.volume, &p), FILTRATION_OK);
            assert_int_equal(filtration_at_volume(&o, change.volume * (1 + 1e-12), &q), FILTRATION_OK);
            assert_close(p.pressure, o.pressure, 1e-9);
            assert_close(q.flow, o.rate, 1e-9);
            assert_close(q.cake, p.cake, 1e-9);
            assert_close(q.time, p.time, 1e-9);
            for (double V = 1.1 * change.volume; V < 1e3 * change.volume; V *= 3.0) {
                const double h = 1e-4 * V;
                filtration_point before, after;
                assert_int_equal(filtration_at_volume(&o, V, &p), FILTRATION_OK);
                assert_int_equal(filtration_at_volume(&o, V - h, &before), FILTRATION_OK);
                assert_int_equal(filtration_at_volume(&o, V + h, &after), FILTRATION_OK);
                assert_close((after.time - before.time) / (2 * h), 1.0 / p.flow, 1e-7);
                /* the resistance at the pressure in the cake */
                const double r =
                    filtration_power_law(o.product, o.compressibility, p.cake, o.reference) * V / o.area + o.medium;
                assert_close(p.flow, o.area * o.pressure / (o.viscosity * r), 1e-11);
                assert_close(p.cake + o.viscosity * p.flow / o.area * o.medium, o.pressure, 1e-11);
                const double time = p.time;
                assert_int_equal(filtration_at_time(&o, time, &p), FILTRATION_OK);
                assert_close(p.volume, V, 1e-10);
            }
            assert_int_equal(filtration_at_time(&o, 0.3 * change.time, &p), FILTRATION_OK);
            assert_close(p.volume, 0.3 * change.volume, 1e-13);
        }
}

/* Without a medium a compressible cake is a parabola of its own: t = mu P w^2 / (2 dp). */
static void test_compressible_without_medium(void **state) {
    (void)state;
    filtration_operation o = an_operation(0.6);
    filtration_point p;
    o.medium = 0.0;
    assert_int_equal(filtration_at_volume(&o, 0.02, &p), FILTRATION_OK);
    assert_close(p.time, 1e-3 * 2e12 * pow(3.0, 0.6) * 0.4 * 0.4 / (2 * 3e5), 1e-12);
    /* and with one, time from a fine sum of dw / v */
    o.medium = 4e11;
    double sum = 0.0;
    const int steps = 20000;
    for (int i = 0; i < steps; i++) {
        assert_int_equal(filtration_at_volume(&o, 0.02 * (i + 0.5) / steps, &p), FILTRATION_OK);
        sum += 0.02 / steps / p.flow;
    }
    assert_int_equal(filtration_at_volume(&o, 0.02, &p), FILTRATION_OK);
    assert_close(p.time, sum, 1e-8);
}

static void test_bad_operations(void **state) {
    (void)state;
    filtration_point p;
    const char *field;
    const double bad[] = {NAN, -1.0, HUGE_VAL, 0.0};
    for (int i = 0; i < 4; i++) {
        filtration_operation o = an_operation(0.2), good = o;
        o.viscosity = bad[i];
        assert_int_equal(filtration_operation_check(&o, &field), FILTRATION_BAD_ARGUMENT);
        assert_string_equal(field, "viscosity");
        o = good, o.area = bad[i];
        assert_int_equal(filtration_at_volume(&o, 1.0, &p), FILTRATION_BAD_ARGUMENT);
        o = good, o.reference = bad[i];
        assert_int_equal(filtration_at_time(&o, 1.0, &p), FILTRATION_BAD_ARGUMENT);
        o = good, o.medium = bad[i];
        if (i < 3) assert_int_equal(filtration_operation_check(&o, NULL), FILTRATION_BAD_ARGUMENT);
        o = good, o.product = bad[i];
        if (i < 3) assert_int_equal(filtration_operation_check(&o, &field), FILTRATION_BAD_ARGUMENT);
        o = good, o.compressibility = i == 3 ? 1.0 : bad[i];
        assert_int_equal(filtration_operation_check(&o, NULL), FILTRATION_BAD_ARGUMENT);
        o = good, o.pressure = bad[i]; /* infinite pressure with infinite rate is the third */
        assert_int_equal(filtration_operation_check(&o, NULL), FILTRATION_BAD_ARGUMENT);
        o = good, o.rate = bad[i];
        if (i != 2) assert_int_equal(filtration_operation_check(&o, NULL), FILTRATION_BAD_ARGUMENT);
        if (i < 3) assert_int_equal(filtration_at_volume(&good, bad[i], &p), FILTRATION_BAD_ARGUMENT);
        if (i < 3) assert_int_equal(filtration_at_time(&good, bad[i], &p), FILTRATION_BAD_ARGUMENT);
    }
    filtration_operation o = an_operation(0.0);
    assert_int_equal(filtration_operation_check(NULL, &field), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_change_over(&o, NULL), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_at_volume(NULL, 1.0, &p), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_at_time(&o, 1.0, NULL), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_at_volume(&o, 1e300, &p), FILTRATION_NO_SOLUTION);
    o.medium = o.product = 0.0;
    assert_int_equal(filtration_operation_check(&o, NULL), FILTRATION_BAD_ARGUMENT);
    o = an_operation(0.5); /* tiny and huge numbers: an answer or a status, never an endless loop */
    const double extreme[] = {1e-300, 1e-150, 1e150, 1e300};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) {
            o.product = extreme[i], o.pressure = extreme[j], o.rate = i == j ? extreme[3 - i] : HUGE_VAL;
            for (int k = 0; k < 4; k++) {
                filtration_status s = filtration_at_time(&o, extreme[k], &p);
                assert_true(s == FILTRATION_NO_SOLUTION || (s == FILTRATION_OK && isfinite(p.volume)));
                s = filtration_at_volume(&o, extreme[k], &p);
                assert_true(s == FILTRATION_NO_SOLUTION || (s == FILTRATION_OK && isfinite(p.time)));
            }
        }
}

/* ---- evaluation ---- */

static uint64_t stream;

static double uniform(void) { return random_inner(&stream); }

static double normal(void) { return sqrt(-2.0 * log(uniform())) * cos(6.283185307179586 * uniform()); }

enum { READINGS = 30 };
static const double dp = 1000.0, mu = 1e-3, A = 20e-4, product = 4.14e9, medium = 3.4e6;

static filtration_curve_def a_def(void) {
    filtration_curve_def d = filtration_curve_default_def();
    d.pressure = dp, d.viscosity = mu, d.area = A;
    return d;
}

/* The paper's shape: clean medium up to 2 mL, then a bend to the line that holds from 6 mL. */
static double bent_time(double V) {
    const double slope = filtration_slope(product, dp, mu, A), clean = filtration_intercept(medium, dp, mu, A);
    const double low = 2e-6, high = 6e-6; /* t / V: clean, a parabola, the line of the slope */
    if (V <= low) return clean * V;
    if (V < high) return V * (clean + slope * (V - low) * (V - low) / (2 * (high - low)));
    return V * (clean + slope * (V - 0.5 * (low + high)));
}

static void test_exact_line(void **state) {
    (void)state;
    double t[READINGS], V[READINGS];
    const double slope = filtration_slope(product, dp, mu, A), intercept = filtration_intercept(medium, dp, mu, A);
    filtration_curve_def d = a_def();
    filtration_curve c;
    d.cake_ratio = 0.053, d.solids = 40.0;
    for (int i = 0; i < READINGS; i++)
        V[i] = i * 0.5e-6, t[i] = filtration_time_of_volume(slope, intercept, V[i]); /* the first is 0, 0 */
    assert_int_equal(filtration_evaluate(&d, READINGS, t, V, &c), FILTRATION_OK);
    assert_close(c.slope.value, slope, 1e-12);
    assert_close(c.intercept.value, intercept, 1e-11);
    assert_close(c.product.value, product, 1e-12);
    assert_close(c.cake.value, product / 0.053, 1e-12);
    assert_close(c.by_mass.value, product / 40.0, 1e-12);
    assert_close(c.medium.value, medium, 1e-11);
    assert_true(c.used == READINGS - 1 && c.first == 1 && c.last == READINGS - 1);
    assert_true(c.r2 > 1 - 1e-12 && c.scatter < 1e-12);
    assert_int_equal(c.remarks, FILTRATION_NO_REMARK); /* rounding is neither a bend nor like its neighbour */
    d.tolerance = 0.0;
    assert_int_equal(filtration_evaluate(&d, READINGS, t, V, &c), FILTRATION_OK);
    assert_true(c.used == READINGS - 1 && c.remarks == FILTRATION_NO_REMARK);
    d.tolerance = 0.005;
    d.cake_ratio = NAN;
    assert_int_equal(filtration_evaluate(&d, READINGS, t, V, &c), FILTRATION_OK);
    assert_true(isnan(c.cake.value) && c.product.value > 0.0);
    /* a stage that begins later: the same cake, its medium is what lies there already */
    d.start_time = t[10], d.start_volume = V[10];
    assert_int_equal(filtration_evaluate(&d, READINGS, t, V, &c), FILTRATION_OK);
    assert_true(c.first == 11);
    assert_close(c.product.value, product, 1e-11);
    assert_close(c.medium.value, medium, 1e-9);
    assert_true(c.smallest == V[c.first] && c.largest == V[c.last]);
    assert_int_equal(filtration_outside(&c, dp, A, c.largest), 0);
    assert_int_equal(filtration_outside(&c, dp, 3 * A, 3 * c.largest), 0);
    assert_int_equal(filtration_outside(&c, dp, A, 1.02 * c.largest), FILTRATION_OUTSIDE_MORE);
    assert_int_equal(filtration_outside(&c, dp, 3 * A, 3.06 * c.largest), FILTRATION_OUTSIDE_MORE);
    assert_int_equal(filtration_outside(&c, dp, A, 0.97 * c.smallest), FILTRATION_OUTSIDE_LESS);
    assert_int_equal(filtration_outside(&c, 2 * dp, A, c.largest), FILTRATION_OUTSIDE_PRESSURE);
    assert_int_equal(filtration_outside(&c, (double)NAN, A, (double)NAN), 7);
    assert_int_equal(filtration_outside(NULL, dp, A, c.largest), 0);
    assert_string_equal(filtration_outside_text(3), "unknown flag");
    assert_string_not_equal(filtration_outside_text(4), "unknown flag");
    filtration_estimate time;
    assert_int_equal(filtration_predict(&c, dp, A, 0.0, 1e-5, &time), FILTRATION_OK);
    assert_close(time.value, filtration_time_of_volume(slope, intercept, 1e-5), 1e-10);
    assert_int_equal(filtration_predict(&c, 2 * dp, 3 * A, 0.4, 3e-5, &time), FILTRATION_OK);
    filtration_operation o = filtration_operation_default();
    o.area = 3 * A, o.pressure = 2 * dp, o.product = product * pow(2.0, 0.4), o.medium = medium;
    filtration_point p;
    assert_int_equal(filtration_at_volume(&o, 3e-5, &p), FILTRATION_OK);
    assert_close(time.value, p.time, 1e-9);
}

/* The three-reading-per-millilitre curve without noise: the stretch found begins where the line does. */
static void test_stretch_of_a_simulated_curve(void **state) {
    (void)state;
    double t[120], V[120];
    filtration_curve_def d = a_def();
    filtration_curve c;
    for (int i = 0; i < 120; i++) V[i] = (i + 1) * 0.12e-6, t[i] = bent_time(V[i]);
    assert_int_equal(filtration_evaluate(&d, 120, t, V, &c), FILTRATION_OK);
    assert_in_range(c.first, 40, 65); /* 6 mL is index 49 */
    assert_int_equal(c.last, 119);
    assert_close(c.product.value, product, 0.02);
    filtration_estimate clean;
    assert_int_equal(filtration_evaluate_clean(&d, 120, t, V, 2e-6, &clean), FILTRATION_OK);
    assert_close(clean.value, medium, 1e-12);
}

/* Clogging that fades: no place where the line begins. */
static double fading_time(double V) {
    const double slope = filtration_slope(product, dp, mu, A), clean = filtration_intercept(medium, dp, mu, A);
    return V * (clean + slope * (V - 4e-6 * (1.0 - exp(-V / 1e-6))));
}

/* Pores that clog between 2 and 6 mL: flat, steep, and then the line of the cake. An S, which a parabola
   does not see. */
static double clogging_time(double V) {
    const double slope = filtration_slope(product, dp, mu, A), clean = filtration_intercept(medium, dp, mu, A);
    const double x = fmin(fmax((V - 2e-6) / 4e-6, 0.0), 1.0), share = x * x * (3.0 - 2.0 * x);
    return V * (clean + share * slope * V);
}

/* How often the 95 % intervals hold the truth, over `trials` curves. */
static void coverage(const filtration_curve_def *d, int trials, double noise, int bent, double rough,
                     double *of_product, double *of_medium) {
    const double slope = filtration_slope(product, dp, mu, A), intercept = filtration_intercept(medium, dp, mu, A);
    const double true_medium =
        bent == 1 || bent == 2 ? medium - product * 4e-6 / (2 * A) : medium; /* the line of both carried on to V 0 */
    int hits_product = 0, hits_medium = 0, given = 0;
    for (int k = 0; k < trials; k++) {
        double t[READINGS], V[READINGS], error = 0.0;
        for (int i = 0; i < READINGS; i++) {
            error = rough * error + sqrt(1.0 - rough * rough) * normal();
            V[i] = (i + 1) * 0.5e-6;
            t[i] = bent == 3   ? clogging_time(V[i])
                   : bent == 2 ? fading_time(V[i])
                   : bent == 1 ? bent_time(V[i])
                               : filtration_time_of_volume(slope, intercept, V[i]);
            t[i] += noise * V[i] * error;
        }
        for (int i = 1; i < READINGS; i++) t[i] = fmax(t[i], t[i - 1]);
        filtration_curve c;
        assert_int_equal(filtration_evaluate(d, READINGS, t, V, &c), FILTRATION_OK);
        if (c.remarks & FILTRATION_REMARK_BENT) continue; /* no range */
        given++;
        hits_product += c.product.low <= product && product <= c.product.high;
        hits_medium += c.medium.low <= true_medium && true_medium <= c.medium.high;
    }
    assert_true(given > 0.8 * trials);
    *of_product = (double)hits_product / given, *of_medium = (double)hits_medium / given;
}

static void test_coverage(void **state) {
    (void)state;
    double of_product, of_medium;
    filtration_curve_def d = a_def();
    const double noise = 60.0; /* of t / V [s/m3], 1.5 % */
    stream = 43;
    d.automatic = 0, d.independent = 1; /* every reading belongs to the line, and errors are as the method takes them */
    coverage(&d, 1500, noise, 0, 0.0, &of_product, &of_medium);
    assert_true(of_product > 0.93 && of_product < 0.97 && of_medium > 0.93 && of_medium < 0.97);
    d.automatic = 1, d.independent = 0; /* the stretch is chosen, and whether neighbours are alike is not known */
    coverage(&d, 200, noise, 0, 0.0, &of_product, &of_medium);
    assert_true(of_product > 0.92 && of_medium > 0.92);
    for (int shape = 1; shape <= 3; shape++) { /* and from curves that bend, one of which never quite ends to */
        coverage(&d, 20, noise, shape, 0.0, &of_product, &of_medium);
        assert_true(of_product > 0.85 && of_medium > 0.85);
    }
    d.first_volume = 6e-6; /* where the user says where the line begins */
    coverage(&d, 200, noise, 1, 0.0, &of_product, &of_medium);
    assert_true(of_product > 0.92 && of_medium > 0.92);
    d.first_volume = 0.0, d.automatic = 0; /* neighbours alike: with least squares it would be about 0.7 */
    coverage(&d, 200, noise, 0, 0.6, &of_product, &of_medium);
    assert_true(of_product > 0.91 && of_medium > 0.91);
}

/* Few readings whose volumes double: they do not tell how the scatter grows with the volume, and are not to be called
   bent for it. A range that is missing does not hold. */
static void test_doubling_volumes(void **state) {
    (void)state;
    filtration_curve_def d = filtration_curve_default_def(); /* 1 bar, water, 20 cm2 */
    const double slope = filtration_slope(1e12, d.pressure, d.viscosity, d.area);
    const double intercept = filtration_intercept(5e10, d.pressure, d.viscosity, d.area);
    const double twice = filtration_time_of_volume(slope, intercept, 2e-3);
    for (d.independent = 0; d.independent < 2; d.independent++) {
        int hits[3] = {0, 0, 0};
        stream = 3;
        for (int k = 0; k < 300; k++) {
            double t[6], V[6];
            for (int i = 0; i < 6; i++) {
                V[i] = 1e-3 / (1 << (5 - i));
                t[i] = filtration_time_of_volume(slope, intercept, V[i]) * (1.0 + 0.01 * normal());
            }
            filtration_curve c;
            filtration_estimate e;
            assert_int_equal(filtration_evaluate(&d, 6, t, V, &c), FILTRATION_OK);
            hits[0] += c.slope.low <= slope && slope <= c.slope.high;
            hits[1] += c.intercept.low <= intercept && intercept <= c.intercept.high;
            assert_int_equal(filtration_predict(&c, d.pressure, d.area, 0.0, 2e-3, &e), FILTRATION_OK);
            hits[2] += e.low <= twice && twice <= e.high;
        }
        for (int i = 0; i < 3; i++) assert_true(hits[i] >= 0.9 * 300);
    }
}

/* A constant error of the clock: t / V errs most at small volumes. The readings tell it; who knows it says so, and
   knows a little more. Plain least squares of t / V would have 1.7 times the error. */
static void test_weights(void **state) {
    (void)state;
    const double slope = filtration_slope(product, dp, mu, A), intercept = filtration_intercept(medium, dp, mu, A);
    filtration_curve_def d = a_def();
    double found = 0.0, weighed = 0.0, plain = 0.0;
    int hits = 0;
    d.automatic = 0, d.independent = 1;
    stream = 7;
    for (int k = 0; k < 500; k++) {
        double t[READINGS], V[READINGS], sums[4] = {0.0, 0.0, 0.0, 0.0};
        for (int i = 0; i < READINGS; i++) {
            V[i] = (i + 1) * 0.5e-6;
            t[i] = filtration_time_of_volume(slope, intercept, V[i]) + 1e-4 * normal();
            sums[0] += V[i], sums[1] += V[i] * V[i], sums[2] += t[i] / V[i], sums[3] += t[i];
        }
        const double error =
            (sums[1] * sums[2] - sums[0] * sums[3]) / (READINGS * sums[1] - sums[0] * sums[0]) - intercept;
        plain += error * error * A * dp / mu * A * dp / mu;
        filtration_curve c;
        d.time_error = 0.0;
        assert_int_equal(filtration_evaluate(&d, READINGS, t, V, &c), FILTRATION_OK);
        found += (c.medium.value - medium) * (c.medium.value - medium);
        d.time_error = 1e-4;
        assert_int_equal(filtration_evaluate(&d, READINGS, t, V, &c), FILTRATION_OK);
        weighed += (c.medium.value - medium) * (c.medium.value - medium);
        hits += c.medium.low <= medium && medium <= c.medium.high;
    }
    assert_true(weighed < 0.5 * plain && found < 0.6 * plain && weighed < found);
    assert_true(hits > 450 && hits < 490); /* a bend in 10 of 500 takes the interval away */
}

/* What no readings can tell, the user says: a drift of the balance in proportion to time enters slope, intercept
   and prediction. */
static void test_drift(void **state) {
    (void)state;
    const double slope = filtration_slope(product, dp, mu, A), intercept = filtration_intercept(medium, dp, mu, A);
    filtration_curve_def d = a_def();
    /* without: the errors are said to be independent */
    int hits[3] = {0, 0, 0}, without = 0, allowed = 0, open = 0, given = 0;
    d.automatic = 0, d.independent = 1;
    stream = 13;
    for (int k = 0; k < 300; k++) {
        double t[READINGS], V[READINGS];
        const double drift = 0.2e-6 * normal(), end = filtration_time_of_volume(slope, intercept, READINGS * 0.5e-6);
        for (int i = 0; i < READINGS; i++) {
            V[i] = (i + 1) * 0.5e-6;
            t[i] = filtration_time_of_volume(slope, intercept, V[i]);
            V[i] += drift * t[i] / end + 0.1e-6 * normal();
        }
        filtration_curve c;
        filtration_estimate e;
        d.drift_error = 0.0;
        assert_int_equal(filtration_evaluate(&d, READINGS, t, V, &c), FILTRATION_OK);
        if (!(c.remarks & FILTRATION_REMARK_BENT)) without += c.product.low <= product && product <= c.product.high;
        d.independent = 0; /* nothing is said */
        assert_int_equal(filtration_evaluate(&d, READINGS, t, V, &c), FILTRATION_OK);
        if (!(c.remarks & FILTRATION_REMARK_BENT))
            open++, allowed += c.product.low <= product && product <= c.product.high;
        d.drift_error = 0.2e-6, d.independent = 1;
        assert_int_equal(filtration_evaluate(&d, READINGS, t, V, &c), FILTRATION_OK);
        if (c.remarks & FILTRATION_REMARK_BENT) continue;
        given++;
        hits[0] += c.product.low <= product && product <= c.product.high;
        hits[1] += c.medium.low <= medium && medium <= c.medium.high;
        assert_int_equal(filtration_predict(&c, dp, A, 0.0, 12e-6, &e), FILTRATION_OK);
        const double time = filtration_time_of_volume(slope, intercept, 12e-6);
        hits[2] += e.low <= time && time <= e.high;
    }
    assert_true(given > 250 && without < 0.8 * given);
    assert_true(open > 250 && allowed > 0.91 * open);
    for (int i = 0; i < 3; i++) assert_true(hits[i] > 0.91 * given);
}

/* Three readings have an interval, two have none; a clean medium has one of two. */
static void test_few_readings(void **state) {
    (void)state;
    const double slope = filtration_slope(product, dp, mu, A), intercept = filtration_intercept(medium, dp, mu, A);
    double t[3], V[3] = {4e-6, 9e-6, 14e-6};
    filtration_curve_def d = a_def();
    filtration_curve c;
    filtration_estimate e;
    for (int i = 0; i < 3; i++) t[i] = filtration_time_of_volume(slope, intercept, V[i]) * (1.0 + 0.003 * (i == 1));
    assert_int_equal(filtration_evaluate(&d, 2, t, V, &c), FILTRATION_FEW_DATA);
    assert_int_equal(filtration_evaluate(&d, 3, t, V, &c), FILTRATION_OK);
    assert_true(c.used == 3 && c.freedom == 1.0 && (c.remarks & FILTRATION_REMARK_FEW));
    assert_true(c.product.low < product && product < c.product.high && c.product.high - c.product.low > 0.02 * product);
    assert_int_equal(filtration_evaluate_clean(&d, 3, t, V, 5e-6, &e), FILTRATION_FEW_DATA);
    assert_int_equal(filtration_evaluate_clean(&d, 3, t, V, 10e-6, &e), FILTRATION_OK);
    assert_true(e.low < e.value && e.value < e.high);
}

/* Nothing that was not found is a number. */
static void nothing_found(const filtration_curve *c) {
    const filtration_estimate *const all[] = {&c->slope, &c->intercept, &c->product, &c->cake, &c->medium};
    for (int i = 0; i < 5; i++)
        assert_true(isnan(all[i]->value) && isnan(all[i]->error) && isnan(all[i]->low) && isnan(all[i]->high));
    assert_true(isnan(c->covariance) && isnan(c->freedom) && isnan(c->student) && isnan(c->scatter) && isnan(c->r2) &&
                isnan(c->bend));
    assert_true(isnan(c->correlation) && isnan(c->smallest) && isnan(c->largest) && isnan(c->pressure) &&
                isnan(c->area));
    assert_true(c->used == 0 && c->first == 0 && c->last == 0 && c->remarks == 0);
}

static void test_volume_runs_backwards(void **state) {
    (void)state;
    double t[40], V[40];
    filtration_curve_def d = a_def();
    filtration_curve c;
    filtration_estimate e = {1.0, 1.0, 1.0, 1.0};
    for (int i = 0; i < 40; i++)
        t[i] = 10.0 * (i + 1), V[i] = 1e-4 * (i < 20 ? i + 1 : 40 - i); /* rises, and falls back */
    for (int automatic = 0; automatic < 2; automatic++) {
        d.automatic = automatic;
        memset(&c, 0, sizeof c);
        assert_int_equal(filtration_evaluate(&d, 40, t, V, &c), FILTRATION_BAD_ARGUMENT);
        nothing_found(&c);
    }
    assert_int_equal(filtration_evaluate_clean(&d, 40, t, V, 1e-3, &e), FILTRATION_BAD_ARGUMENT);
    assert_true(isnan(e.value) && isnan(e.error) && isnan(e.low) && isnan(e.high));
    assert_int_equal(filtration_evaluate(&d, 20, t, V, &c), FILTRATION_OK);
    /* slowly, or once and then on: a vessel that was emptied */
    for (int i = 0; i < 40; i++) V[i] = i < 20 ? 1e-4 * (i + 1) : 20e-4 - 2.5e-6 * (i - 19);
    assert_int_equal(filtration_evaluate(&d, 40, t, V, &c), FILTRATION_BAD_ARGUMENT);
    for (int i = 0; i < 40; i++) V[i] = 1e-4 * (i % 20 + 1);
    assert_int_equal(filtration_evaluate(&d, 40, t, V, &c), FILTRATION_BAD_ARGUMENT);
    d.start_time = t[19]; /* the second vessel alone */
    assert_int_equal(filtration_evaluate(&d, 40, t, V, &c), FILTRATION_OK);
    assert_int_equal(c.first, 20);
    /* a scale that scatters, readings that stay: both count */
    d = a_def();
    stream = 11;
    const double slope = filtration_slope(product, dp, mu, A), intercept = filtration_intercept(medium, dp, mu, A);
    for (int i = 0; i < 40; i++) {
        V[i] = (i + 1) * 0.1e-6;
        t[i] = filtration_time_of_volume(slope, intercept, V[i]);
        V[i] += 0.04e-6 * (2.0 * uniform() - 1.0);
        if (i % 4) V[i] = V[i - 1] - (i % 4 == 2 ? 0.05e-6 : 0.0); /* 1.25 % of the largest */
    }
    assert_int_equal(filtration_evaluate(&d, 40, t, V, &c), FILTRATION_OK);
    V[30] -= 0.6e-6;
    assert_int_equal(filtration_evaluate(&d, 40, t, V, &c), FILTRATION_BAD_ARGUMENT);
    d.volume_error = 0.15e-6; /* known to scatter as much */
    assert_int_equal(filtration_evaluate(&d, 40, t, V, &c), FILTRATION_OK);
}

/* Errors of pressure, area and K_S enter the resistances, with their own degrees of freedom. */
static void test_errors_of_the_duty(void **state) {
    (void)state;
    double t[READINGS], V[READINGS];
    filtration_curve_def d = a_def();
    filtration_curve plain, wide;
    stream = 5;
    for (int i = 0; i < READINGS; i++) V[i] = (i + 1) * 0.5e-6, t[i] = bent_time(V[i]) * (1 + 1e-3 * normal());
    d.cake_ratio = 0.05, d.first_volume = 6e-6;
    assert_int_equal(filtration_evaluate(&d, READINGS, t, V, &plain), FILTRATION_OK);
    d.pressure_error = 0.03, d.area_error = 0.02, d.cake_ratio_error = 0.1, d.viscosity_error = 0.01;
    assert_int_equal(filtration_evaluate(&d, READINGS, t, V, &wide), FILTRATION_OK);
    const double own = plain.product.error / plain.product.value;
    assert_close(wide.product.error / wide.product.value, sqrt(own * own + 0.03 * 0.03 + 0.01 * 0.01 + 4 * 0.02 * 0.02),
                 1e-12);
    assert_close(wide.cake.error / wide.cake.value,
                 sqrt(own * own + 0.03 * 0.03 + 0.01 * 0.01 + 4 * 0.02 * 0.02 + 0.01), 1e-12);
    assert_true((wide.cake.high - wide.cake.value) / wide.cake.error < wide.student); /* more degrees of freedom */
    assert_true(wide.slope.error == plain.slope.error);
}

static void test_remarks(void **state) {
    (void)state;
    double t[40], V[40];
    filtration_curve_def d = a_def();
    filtration_curve c;
    for (int i = 0; i < 40; i++) V[i] = (i + 1) * 0.4e-6, t[i] = V[i] * (1700.0 + 5e8 * V[i] + 3e13 * V[i] * V[i]);
    d.automatic = 0;
    assert_int_equal(filtration_evaluate(&d, 40, t, V, &c), FILTRATION_OK);
    assert_true(c.remarks & FILTRATION_REMARK_BENT);
    assert_true(c.remarks & FILTRATION_REMARK_CORRELATED);
    for (int i = 0; i < 40; i++) t[i] = V[i] * (5e8 * V[i] - 200.0) + 1e-2;
    d.first_volume = 2e-6;
    assert_int_equal(filtration_evaluate(&d, 40, t, V, &c), FILTRATION_OK);
    stream = 9;
    for (int i = 0; i < 40; i++) t[i] = V[i] * 1700.0 * (1 + 1e-3 * normal());
    d.first_volume = 0.0;
    assert_int_equal(filtration_evaluate(&d, 40, t, V, &c), FILTRATION_OK);
    assert_true(c.remarks & FILTRATION_REMARK_SLOPE);
    for (int i = 0; i < 40; i++) t[i] = V[i] * (8e8 * (V[i] + 1e-6) - 1500.0) + 1e-3;
    d.first_volume = 4e-6;
    assert_int_equal(filtration_evaluate(&d, 40, t, V, &c), FILTRATION_OK);
    assert_true(c.intercept.value < 0.0 && (c.remarks & FILTRATION_REMARK_MEDIUM));
    assert_string_equal(filtration_remark_text(0), "nothing to remark");
    assert_non_null(strstr(filtration_remark_text(FILTRATION_REMARK_MEDIUM), "negative"));
    assert_string_equal(filtration_remark_text(64), "unknown remark");
}

static void test_bad_curves(void **state) {
    (void)state;
    double t[8] = {1, 2, 3, 4, 5, 6, 7, 8}, V[8] = {1, 2, 3, 4, 5, 6, 7, 8};
    filtration_curve_def d = a_def();
    filtration_curve c;
    filtration_estimate e;
    const char *field = NULL;
    assert_int_equal(filtration_curve_check_def(NULL, &field), FILTRATION_BAD_DEF);
    assert_string_equal(field, "def");
    assert_int_equal(filtration_curve_check_def(&d, &field), FILTRATION_OK);
    assert_null(field);
    assert_int_equal(filtration_evaluate(NULL, 8, t, V, &c), FILTRATION_BAD_DEF);
    nothing_found(&c);
    assert_int_equal(filtration_evaluate(&d, 8, t, V, NULL), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_evaluate(&d, 8, NULL, V, &c), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_evaluate(&d, 0, NULL, NULL, &c), FILTRATION_FEW_DATA);
    assert_int_equal(filtration_evaluate(&d, 2, t, V, &c), FILTRATION_FEW_DATA);
    nothing_found(&c);
    e.value = e.error = 1.0;
    assert_int_equal(filtration_predict(&c, dp, A, 0.0, 1e-5, &e), FILTRATION_BAD_ARGUMENT);
    assert_true(isnan(e.value) && isnan(e.error));
    assert_int_equal(filtration_outside(&c, dp, A, 1e-5), 7);
    e.value = e.error = 1.0;
    assert_int_equal(filtration_evaluate_clean(&d, 8, t, V, NAN, &e), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_evaluate_clean(&d, 8, t, V, 1.5, &e), FILTRATION_FEW_DATA);
    assert_true(isnan(e.value) && isnan(e.error) && isnan(e.low) && isnan(e.high));
    assert_int_equal(filtration_evaluate_clean(NULL, 8, t, V, 1.5, &e), FILTRATION_BAD_DEF);
    const double bad[] = {NAN, HUGE_VAL, -HUGE_VAL, -1.0};
    for (int i = 0; i < 4; i++) {
        const double kept = V[3], when = t[3];
        V[3] = bad[i];
        assert_int_equal(filtration_evaluate(&d, 8, t, V, &c), FILTRATION_BAD_ARGUMENT);
        V[3] = kept, t[3] = bad[i];
        assert_int_equal(filtration_evaluate(&d, 8, t, V, &c), FILTRATION_BAD_ARGUMENT);
        t[3] = when;
        assert_int_equal(filtration_predict(&c, bad[i], 1, 0, 1, &e), FILTRATION_BAD_ARGUMENT);
        assert_int_equal(filtration_predict(&c, 1, bad[i], 0, 1, &e), FILTRATION_BAD_ARGUMENT);
    }
    const double same[8] = {3, 3, 3, 3, 3, 3, 3, 3}, zero[8] = {0, 0, 0, 0, 0, 0, 0, 0};
    assert_int_equal(filtration_evaluate(&d, 8, t, same, &c), FILTRATION_NO_SOLUTION);
    assert_int_equal(filtration_evaluate(&d, 8, t, zero, &c), FILTRATION_FEW_DATA);
    assert_int_equal(filtration_evaluate(&d, 8, same, V, &c), FILTRATION_OK); /* t / V falls: answered, with a remark */
    assert_true(c.remarks & FILTRATION_REMARK_SLOPE);
    for (int power = -300; power <= 300;
         power += 100) { /* the scale of the numbers does not matter, but for the range of doubles */
        double small_t[8], small_V[8];
        for (int i = 0; i < 8; i++)
            small_V[i] = V[i] * pow(10.0, power), small_t[i] = (t[i] * V[i] + 3 * t[i]) * pow(10.0, power);
        const filtration_status s = filtration_evaluate(&d, 8, small_t, small_V, &c);
        assert_true(s == FILTRATION_OK || (abs(power) == 300 && s == FILTRATION_NO_SOLUTION));
        if (s != FILTRATION_OK) nothing_found(&c);
    }
    struct {
        size_t offset;
        const char *name;
    } fields[] = {{offsetof(filtration_curve_def, pressure), "pressure"},
                  {offsetof(filtration_curve_def, viscosity), "viscosity"},
                  {offsetof(filtration_curve_def, area), "area"},
                  {offsetof(filtration_curve_def, cake_ratio), "cake_ratio"},
                  {offsetof(filtration_curve_def, area_error), "area_error"},
                  {offsetof(filtration_curve_def, solids), "solids"},
                  {offsetof(filtration_curve_def, solids_error), "solids_error"},
                  {offsetof(filtration_curve_def, drift_error), "drift_error"},
                  {offsetof(filtration_curve_def, time_error), "time_error"},
                  {offsetof(filtration_curve_def, tolerance), "tolerance"},
                  {offsetof(filtration_curve_def, confidence), "confidence"},
                  {offsetof(filtration_curve_def, bend_level), "bend_level"},
                  {offsetof(filtration_curve_def, start_volume), "start_volume"},
                  {offsetof(filtration_curve_def, first_volume), "first_volume"},
                  {offsetof(filtration_curve_def, last_volume), "last_volume"}};
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        filtration_curve_def wrong = a_def();
        const double minus = -1.0;
        memcpy((char *)&wrong + fields[i].offset, &minus, sizeof minus);
        assert_int_equal(filtration_curve_check_def(&wrong, &field), FILTRATION_BAD_DEF);
        assert_string_equal(field, fields[i].name);
        assert_int_equal(filtration_evaluate(&wrong, 8, t, V, &c), FILTRATION_BAD_DEF);
    }
    d.least_readings = 4;
    assert_int_equal(filtration_curve_check_def(&d, &field), FILTRATION_BAD_DEF);
    memset(&d, 0, sizeof d);
    assert_int_equal(filtration_curve_check_def(&d, &field), FILTRATION_BAD_DEF);
    assert_string_equal(field, "cookie");
}

/* A power law from runs at several pressures: exact without scatter, and its intervals hold with scatter in and
   between the runs. */
static void test_compressibility(void **state) {
    (void)state;
    double p[6] = {0.5e5, 1e5, 1.5e5, 2.5e5, 4e5, 6e5}, value[6], error[6];
    filtration_compressibility fit;
    filtration_estimate e;
    for (int i = 0; i < 6; i++) value[i] = 2e11 * pow(p[i] / 1e5, 0.42), error[i] = 0.01;
    for (size_t runs = 2; runs <= 6; runs++) { /* also in another order, and in other units of the value */
        assert_int_equal(filtration_fit_compressibility(runs, p, value, runs == 4 ? NULL : error, 1e5, 0.95, &fit),
                         FILTRATION_OK);
        assert_close(fit.exponent.value, 0.42, 1e-10);
        assert_close(fit.at_reference.value, 2e11, 1e-10);
        assert_true(isnan(fit.exponent.low) == (runs == 2) && isnan(fit.at_reference.high) == (runs == 2));
        assert_true(runs == 2 || fit.between < 1e-9);
        assert_int_equal(filtration_value_at_pressure(&fit, 3e5, &e), FILTRATION_OK);
        assert_close(e.value, 2e11 * pow(3.0, 0.42), 1e-9);
    }
    const int all = 1500;
    stream = 77;
    for (int design = 0; design < 4; design++) {
        const size_t runs = design == 0 ? 3 : design == 1 ? 4 : 6;
        const double between = design == 3 ? 0.0 : 0.08;
        int hits[3] = {0, 0, 0};
        for (int k = 0; k < all; k++) {
            for (size_t i = 0; i < runs; i++) {
                error[i] = i % 2 ? 0.05 : 0.02;
                value[i] = 2e11 * pow(p[i] / 1e5, 0.42) * exp(between * normal() + error[i] * normal());
            }
            assert_int_equal(filtration_fit_compressibility(runs, p, value, error, 1e5, 0.95, &fit), FILTRATION_OK);
            hits[0] += fit.exponent.low <= 0.42 && 0.42 <= fit.exponent.high;
            hits[1] += fit.at_reference.low <= 2e11 && 2e11 <= fit.at_reference.high;
            assert_int_equal(filtration_value_at_pressure(&fit, 1e6, &e), FILTRATION_OK);
            hits[2] += e.low <= 2e11 * pow(10.0, 0.42) && 2e11 * pow(10.0, 0.42) <= e.high;
        }
        for (int i = 0; i < 3; i++) assert_true(hits[i] > 0.92 * all && hits[i] < 0.985 * all);
    }
    /* bad input */
    const double bad[] = {NAN, HUGE_VAL, -1.0, 0.0};
    for (int i = 0; i < 4; i++) {
        double wrong[6];
        memcpy(wrong, value, sizeof wrong);
        wrong[2] = bad[i];
        assert_int_equal(filtration_fit_compressibility(6, p, wrong, error, 1e5, 0.95, &fit), FILTRATION_BAD_ARGUMENT);
        assert_true(isnan(fit.exponent.value) && isnan(fit.at_reference.low) && isnan(fit.reference));
        assert_int_equal(filtration_fit_compressibility(6, wrong, value, error, 1e5, 0.95, &fit),
                         FILTRATION_BAD_ARGUMENT);
        assert_int_equal(filtration_fit_compressibility(6, p, value, error, bad[i], 0.95, &fit),
                         FILTRATION_BAD_ARGUMENT);
        assert_int_equal(filtration_fit_compressibility(6, p, value, error, 1e5, bad[i], &fit),
                         FILTRATION_BAD_ARGUMENT);
        assert_int_equal(filtration_value_at_pressure(&fit, 1e5, &e), FILTRATION_BAD_ARGUMENT);
    }
    const double same[3] = {1e5, 1e5, 1e5};
    assert_int_equal(filtration_fit_compressibility(3, same, value, error, 1e5, 0.95, &fit), FILTRATION_NO_SOLUTION);
    assert_int_equal(filtration_fit_compressibility(1, p, value, error, 1e5, 0.95, &fit), FILTRATION_FEW_DATA);
    assert_int_equal(filtration_fit_compressibility(3, p, value, error, 1e5, 0.95, NULL), FILTRATION_BAD_ARGUMENT);
    assert_int_equal(filtration_fit_compressibility(3, NULL, value, error, 1e5, 0.95, &fit), FILTRATION_BAD_ARGUMENT);
}

static void test_status_text(void **state) {
    (void)state;
    for (int i = 0; i < FILTRATION_STATUS_COUNT; i++)
        assert_true(strlen(filtration_status_text((filtration_status)i)) > 1);
    assert_string_equal(filtration_status_text(FILTRATION_OK), "ok");
    assert_string_equal(filtration_status_text((filtration_status)999), "unknown status");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_filtration_equation),
        cmocka_unit_test(test_inverse_of_time),
        cmocka_unit_test(test_kozeny_carman),
        cmocka_unit_test(test_cake_ratios),
        cmocka_unit_test(test_compressible_means),
        cmocka_unit_test(test_student),
        cmocka_unit_test(test_laws_out_of_domain),
        cmocka_unit_test(test_settling_laws),
        cmocka_unit_test(test_number_shares),
        cmocka_unit_test(test_number_distribution),
        cmocka_unit_test(test_bad_distributions),
        cmocka_unit_test(test_constant_pressure),
        cmocka_unit_test(test_constant_rate),
        cmocka_unit_test(test_both_in_turn),
        cmocka_unit_test(test_compressible_without_medium),
        cmocka_unit_test(test_bad_operations),
        cmocka_unit_test(test_exact_line),
        cmocka_unit_test(test_stretch_of_a_simulated_curve),
        cmocka_unit_test(test_coverage),
        cmocka_unit_test(test_doubling_volumes),
        cmocka_unit_test(test_weights),
        cmocka_unit_test(test_drift),
        cmocka_unit_test(test_few_readings),
        cmocka_unit_test(test_volume_runs_backwards),
        cmocka_unit_test(test_errors_of_the_duty),
        cmocka_unit_test(test_remarks),
        cmocka_unit_test(test_bad_curves),
        cmocka_unit_test(test_compressibility),
        cmocka_unit_test(test_status_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
