/* The laws of the filtration equation: pure functions of scalars. */
#pragma once
#include "process_api.h"
#include "../../base/portable_math.h"
#include "../../base/student.h"

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
    /* Avoids the difference of nearly equal numbers. */
    return 2.0 * t / (intercept + sqrt(intercept * intercept + 4.0 * slope * t));
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

/* Returns the porosity y^2, where s y^3 + y^2 = 1 and s = d sqrt(r_K / constant); by Newton's method from the right of
   the root of a convex function. */
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

static inline double filtration_student(double confidence, double freedom) {
    return riddle_student(confidence, freedom);
}
