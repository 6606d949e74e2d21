/* The laws of the filtration equation: pure functions of scalars. */
#pragma once
#include "process_api.h"
#include "../../base/portable_math.h"

/* ==== >>process ==== */

static inline double filtration_velocity(double dp, double mu, double cake, double medium) {
    if (!(dp > 0.0 && mu > 0.0 && cake >= 0.0 && medium >= 0.0 && cake + medium > 0.0)) return (double)NAN;
    return dp / (mu * (cake + medium));
}

static inline double filtration_resistance(double dp, double mu, double velocity) {
    return dp > 0.0 && mu > 0.0 && velocity > 0.0 ? dp / (mu * velocity) : (double)NAN;
}

static inline double filtration_cake_resistance(double specific, double height) {
    return specific >= 0.0 && height >= 0.0 ? specific * height : (double)NAN;
}

static inline double filtration_medium_resistance(double clean, double interference) {
    return clean >= 0.0 && interference >= 0.0 ? clean + interference : (double)NAN;
}

static inline int filtration__duty_is_good(double dp, double mu, double A) { return dp > 0.0 && mu > 0.0 && A > 0.0; }

static inline double filtration_slope(double product, double dp, double mu, double A) {
    if (!(product >= 0.0 && filtration__duty_is_good(dp, mu, A))) return (double)NAN;
    return mu * product / (2.0 * A * A * dp);
}

static inline double filtration_intercept(double medium, double dp, double mu, double A) {
    return medium >= 0.0 && filtration__duty_is_good(dp, mu, A) ? mu * medium / (A * dp) : (double)NAN;
}

static inline double filtration_product_of_slope(double slope, double dp, double mu, double A) {
    return filtration__duty_is_good(dp, mu, A) ? 2.0 * A * A * dp * slope / mu : (double)NAN;
}

static inline double filtration_medium_of_intercept(double intercept, double dp, double mu, double A) {
    return filtration__duty_is_good(dp, mu, A) ? intercept * A * dp / mu : (double)NAN;
}

static inline double filtration_time_of_volume(double slope, double intercept, double V) {
    return slope >= 0.0 && intercept >= 0.0 && V >= 0.0 ? (slope * V + intercept) * V : (double)NAN;
}

static inline double filtration_volume_of_time(double slope, double intercept, double t) {
    if (!(slope >= 0.0 && intercept >= 0.0 && slope + intercept > 0.0 && t >= 0.0)) return (double)NAN;
    if (t == 0.0) return 0.0;
    return 2.0 * t / (intercept + sqrt(intercept * intercept + 4.0 * slope * t)); /* avoids the difference of nearly equal numbers */
}

static inline double filtration_pressure(double product, double medium, double mu, double v, double w) {
    if (!(product >= 0.0 && medium >= 0.0 && mu > 0.0 && v >= 0.0 && w >= 0.0)) return (double)NAN;
    return mu * v * (product * w + medium);
}

static inline double filtration_power_law(double value_1, double exponent, double p, double p_1) {
    if (!(value_1 >= 0.0 && p >= 0.0 && p_1 > 0.0 && exponent == exponent)) return (double)NAN;
    return value_1 * riddle_pow(p / p_1, exponent);
}

static inline double filtration_mean_of_local(double local, double n) {
    return local >= 0.0 && n >= 0.0 && n < 1.0 ? local * (1.0 - n) : (double)NAN;
}

static inline double filtration_mean_solid(double local, double n, double beta) {
    if (!(local >= 0.0 && local <= 1.0 && n >= 0.0 && beta >= 0.0 && n + beta < 1.0)) return (double)NAN;
    return local * (1.0 - n - beta) / (1.0 - n);
}

static inline double filtration_kozeny_carman(double porosity, double d, double constant) {
    if (!(porosity > 0.0 && porosity <= 1.0 && d > 0.0 && constant > 0.0)) return (double)NAN;
    const double ratio = (1.0 - porosity) / d;
    return constant * ratio * ratio / (porosity * porosity * porosity);
}

/* Returns the porosity y^2, where s y^3 + y^2 = 1 and s = d sqrt(r_K / constant); by Newton's method from the right of the root of a convex
   function. */
static inline double filtration_kozeny_porosity(double specific, double d, double constant) {
    if (!(specific > 0.0 && d > 0.0 && constant > 0.0)) return (double)NAN;
    const double s = d * sqrt(specific / constant);
    if (!(s <= 1.7976931348623157e308)) return (double)NAN;
    double y = s > 1.0 ? 1.0 / riddle_cbrt(s) : 1.0;
    for (int i = 0; i < 100; i++) {
        const double next = y - ((s * y + 1.0) * y * y - 1.0) / ((3.0 * s * y + 2.0) * y);
        if (!(next < y)) break;
        y = next;
    }
    return y * y;
}

static inline double filtration_cake_ratio(double c, double porosity) {
    if (!(c >= 0.0 && porosity >= 0.0 && c + porosity < 1.0)) return (double)NAN;
    return c / (1.0 - porosity - c);
}

static inline double filtration_cake_ratio_of_solid(double solid, double porosity, double V) {
    return solid >= 0.0 && porosity >= 0.0 && porosity < 1.0 && V > 0.0 ? solid / ((1.0 - porosity) * V) : (double)NAN;
}

static inline double filtration_cake_ratio_of_height(double height, double A, double V) {
    return height >= 0.0 && A > 0.0 && V > 0.0 ? height * A / V : (double)NAN;
}

static inline double filtration_mass_resistance(double specific, double porosity, double density) {
    if (!(specific >= 0.0 && porosity >= 0.0 && porosity < 1.0 && density > 0.0)) return (double)NAN;
    return specific / (density * (1.0 - porosity));
}

/* ---- Student's distribution ---- */

/* Returns the logarithm of the beta function B(a, 1/2), a > 0, by the expansion of gamma(a + 1/2) / gamma(a) from 20 on. */
static inline double filtration__log_beta_half(double a) {
    double ratio = 1.0;
    for (; a < 20.0; a += 1.0) ratio *= (a + 0.5) / a;
    const double z = 1.0 / (a * a), series = (1.0 / 8.0 - z * (1.0 / 192.0 - z * (1.0 / 640.0 - z * 17.0 / 14336.0))) / a;
    return 0.57236494292470008707 - 0.5 * riddle_log(a) + series + riddle_log(ratio);
}

/* Returns the continued fraction of the incomplete beta function (Lentz's method; Abramowitz and Stegun 26.5.8). */
static inline double filtration__beta_fraction(double a, double b, double x) {
    const double tiny = 1e-300;
    double c = 1.0, d = 1.0 - (a + b) * x / (a + 1.0);
    d = 1.0 / (fabs(d) > tiny ? d : tiny);
    double h = d;
    for (int m = 1; m < 10000; m++) {
        const double even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        for (int k = 0; k < 2; k++) {
            const double factor = k == 0 ? even : odd;
            d = 1.0 + factor * d;
            d = 1.0 / (fabs(d) > tiny ? d : tiny);
            c = 1.0 + factor / c;
            c = fabs(c) > tiny ? c : tiny;
            h *= d * c;
        }
        if (fabs(d * c - 1.0) < 1e-15) break;
    }
    return h;
}

/* Returns P(|T| > t), t >= 0, and the density of |T| there. */
static inline double filtration__student_tail(double freedom, double t, double *density) {
    const double a = 0.5 * freedom, b = 0.5, x = freedom / (freedom + t * t), rest = t * t / (freedom + t * t);
    const double log_x = -riddle_log1p(t * t / freedom), log_beta = filtration__log_beta_half(a);
    *density = 2.0 / sqrt(freedom) * riddle_exp((a + 0.5) * log_x - log_beta);
    if (!(rest > 0.0)) return 1.0;
    const double front = riddle_exp(a * log_x - log_beta) * sqrt(rest);
    if (x < (a + 1.0) / (a + b + 2.0)) return front * filtration__beta_fraction(a, b, x) / a;
    return 1.0 - front * filtration__beta_fraction(b, a, rest) / b;
}

static inline double filtration_student(double confidence, double freedom) {
    if (!(confidence > 0.0 && confidence < 1.0 && freedom > 0.0)) return (double)NAN;
    if (freedom > 1e8) freedom = 1e8; /* the normal distribution, to 1e-8 */
    double low = 0.0, high = 1.0, density;
    while (high < 1e150 && filtration__student_tail(freedom, high, &density) > 1.0 - confidence) low = high, high *= 2.0;
    double t = high;
    for (int i = 0; i < 200; i++) { /* Newton's method, kept within the bracket */
        const double excess = filtration__student_tail(freedom, t, &density) - (1.0 - confidence);
        if (excess > 0.0) low = t;
        else high = t;
        double next = t + excess / density;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (next == t || fabs(next - t) <= 1e-15 * t) break;
        t = next;
    }
    return t;
}
