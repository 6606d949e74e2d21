/* The power law of a compressible cake from runs at several pressures. */
#pragma once
#include "evaluate.h"

/* Fits the line of logarithms with weights 1 / (error^2 + between^2), error the runs' own; between HUGE_VAL: equal
   weights. */
static inline filtration__kind filtration__fit_law(size_t n, const double *pressure, const double *value,
                                                   const double *error, double reference, double between) {
    double weights = 0.0, mean_x = 0.0, mean_y = 0.0, sxx = 0.0, sxy = 0.0, logs = 0.0;
    filtration__kind kind;
    memset(&kind, 0, sizeof kind);
    for (int pass = 0; pass < 3; pass++) {
        for (size_t i = 0; i < n; i++) {
            const double own = between < HUGE_VAL ? error[i] : 0.0, more = between < HUGE_VAL ? between : 1.0;
            const double weight = 1.0 / (own * own + more * more);
            const double x = riddle_log(pressure[i] / reference), y = riddle_log(value[i]);
            if (pass == 0)
                weights += weight, mean_x += weight * x, mean_y += weight * y, logs += 0.5 * riddle_log(weight);
            else if (pass == 1)
                sxx += weight * (x - mean_x) * (x - mean_x), sxy += weight * (x - mean_x) * (y - mean_y);
            else {
                const double rest = y - mean_y - kind.slope * (x - mean_x);
                kind.squares += weight * rest * rest;
            }
        }
        if (pass == 0) mean_x /= weights, mean_y /= weights;
        else if (pass == 1) kind.slope = sxy / sxx;
    }
    const double least = weights * FILTRATION__ROUNDING * FILTRATION__ROUNDING;
    if (!(kind.squares > least)) kind.squares = least;
    kind.level = mean_y - kind.slope * mean_x;
    kind.of_level = 1.0 / weights + mean_x * mean_x / sxx, kind.of_both = -mean_x / sxx, kind.of_slope = 1.0 / sxx;
    kind.likelihood = logs - 0.5 * riddle_log(weights * sxx) - 0.5 * ((double)n - 2.0) * riddle_log(kind.squares);
    return kind;
}

/* The mean over how much runs may scatter beyond their errors: not at all, as much again, three times as much, or so
   much that the errors do not matter. The size of the scatter follows from the departures from the law. */
static inline void filtration__mix_laws(size_t n, const double *pressure, const double *value, const double *error,
                                        double reference, double confidence, filtration__mixture *m) {
    static const double beyond[] = {0.0, 1.0, 3.0};
    double mean = 0.0, best, sum = 0.0;
    int known = error != NULL;
    for (size_t i = 0; i < n && known; i++) known = error[i] > 0.0, mean += error[i] * error[i] / (double)n;
    memset(m, 0, sizeof *m);
    m->freedom = (double)n - 2.0, m->confidence = confidence;
    m->student = n > 2 ? filtration_student(confidence, m->freedom) : (double)NAN;
    for (int k = 0; k < 3 && known; k++)
        m->kind[m->n++] = filtration__fit_law(n, pressure, value, error, reference, beyond[k] * sqrt(mean));
    m->kind[m->n++] = filtration__fit_law(n, pressure, value, error, reference, HUGE_VAL);
    best = m->kind[0].likelihood;
    for (int k = 1; k < m->n; k++)
        if (m->kind[k].likelihood > best) best = m->kind[k].likelihood;
    for (int k = 0; k < m->n; k++) sum += m->share[k] = riddle_exp(m->kind[k].likelihood - best);
    for (int k = 0; k < m->n; k++) {
        m->share[k] /= sum;
        m->level += m->share[k] * m->kind[k].level, m->slope += m->share[k] * m->kind[k].slope;
    }
}

FILTRATION_API filtration_status filtration_value_at_pressure(const filtration_compressibility *fit, double pressure,
                                                              filtration_estimate *value) {
    if (!value) return FILTRATION_BAD_ARGUMENT;
    *value = filtration__estimate((double)NAN, (double)NAN, (double)NAN);
    if (!fit || !filtration__is_positive(pressure) || !filtration__is_positive(fit->reference))
        return FILTRATION_BAD_ARGUMENT;
    const double x = riddle_log(pressure / fit->reference), at = fit->at_reference.value;
    const double of_level = fit->at_reference.error / at, of_exponent = fit->exponent.error;
    const double variance = of_level * of_level + 2.0 * x * fit->covariance + x * x * of_exponent * of_exponent;
    const double error = variance > 0.0 ? sqrt(variance) : variance == variance ? 0.0 : (double)NAN;
    value->value = filtration_power_law(at, fit->exponent.value, pressure, fit->reference);
    value->error = error * value->value;
    value->low = value->value * riddle_exp(-fit->student * error);
    value->high = value->value * riddle_exp(fit->student * error);
    return filtration__is_finite(value->value) ? FILTRATION_OK : FILTRATION_NO_SOLUTION;
}

/* Checks the runs and finds the range of their pressures. */
static inline filtration_status filtration__check_runs(size_t runs, const double *pressure, const double *value,
                                                       const double *error, double *lowest, double *highest) {
    if (runs < 2) return FILTRATION_FEW_DATA;
    if (!pressure || !value) return FILTRATION_BAD_ARGUMENT;
    *lowest = HUGE_VAL, *highest = 0.0;
    for (size_t i = 0; i < runs; i++) {
        if (!filtration__is_positive(pressure[i]) || !filtration__is_positive(value[i])) return FILTRATION_BAD_ARGUMENT;
        if (error && (error[i] < 0.0 || error[i] > FILTRATION__LARGEST)) return FILTRATION_BAD_ARGUMENT;
        if (pressure[i] < *lowest) *lowest = pressure[i];
        if (pressure[i] > *highest) *highest = pressure[i];
    }
    return *highest > *lowest * (1.0 + 1e-9) ? FILTRATION_OK : FILTRATION_NO_SOLUTION;
}

FILTRATION_API filtration_status filtration_fit_compressibility(size_t runs, const double *pressure,
                                                                const double *value, const double *error,
                                                                double reference, double confidence,
                                                                filtration_compressibility *fit) {
    double lowest, highest, own = 0.0;
    filtration__mixture m;
    if (!fit) return FILTRATION_BAD_ARGUMENT;
    memset(fit, 0, sizeof *fit);
    fit->exponent = fit->at_reference = filtration__estimate((double)NAN, (double)NAN, (double)NAN);
    fit->covariance = fit->between = fit->freedom = fit->student = fit->lowest = fit->highest = (double)NAN;
    fit->reference = fit->confidence = (double)NAN;
    if (!filtration__is_positive(reference) || !(confidence > 0.0 && confidence < 1.0)) return FILTRATION_BAD_ARGUMENT;
    const filtration_status status = filtration__check_runs(runs, pressure, value, error, &lowest, &highest);
    if (status != FILTRATION_OK) return status;
    filtration__mix_laws(runs, pressure, value, error, reference, confidence, &m);
    const double at = riddle_exp(m.level), middle = 0.5 * riddle_log(lowest / reference * (highest / reference));
    if (!filtration__is_finite(m.slope) || !filtration__is_positive(at)) return FILTRATION_NO_SOLUTION;
    const double of_slope = filtration__error_of(&m, 0.0, 1.0), of_level = filtration__error_of(&m, 1.0, 0.0);
    const double of_middle = filtration__error_of(&m, 1.0, middle), most = of_slope * of_level;
    double both = 0.0; /* so that the interval in the middle of the pressures is right, too */
    if (fabs(middle) > 1e-9)
        both = (of_middle * of_middle - of_level * of_level - middle * middle * of_slope * of_slope) / (2.0 * middle);
    both = both > most ? most : both < -most ? -most : both;
    fit->reference = reference, fit->confidence = confidence, fit->runs = runs;
    fit->lowest = lowest, fit->highest = highest, fit->freedom = m.freedom, fit->student = m.student;
    fit->exponent = filtration__estimate(m.slope, of_slope, m.student);
    fit->at_reference = filtration__estimate(at, at * of_level, m.student);
    fit->covariance = both;
    for (size_t i = 0; i < runs; i++) own += error && error[i] > 0.0 ? error[i] * error[i] / (double)runs : 0.0;
    const double more = m.kind[m.n - 1].squares / m.freedom - own;
    fit->between = runs < 3 ? (double)NAN : more > 0.0 ? sqrt(more) : 0.0;
    filtration_estimate there;
    filtration_value_at_pressure(fit, reference, &there);
    fit->at_reference = there;
    return FILTRATION_OK;
}
