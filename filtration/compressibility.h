/* compressibility.h: the power law of a compressible cake from runs at several pressures. Relies on base.h, process_api.h, process_laws.h,
   process.h.
   May be changed here alone: how runs are weighed. */

/* Logarithms of value over pressure, and the line through them with weights 1 / (error^2 + between^2). */
typedef struct filtration__law {
    double weights, mean_x, mean_y, sxx, slope, squares; /* squares: of the departures, weighted */
} filtration__law;

static inline filtration__law filtration__law_of(size_t n, const double *pressure, const double *value,
                                                 const double *error, double reference, double between) {
    filtration__law l;
    double sxy = 0.0;
    memset(&l, 0, sizeof l);
    for (int pass = 0; pass < 3; pass++)
        for (size_t i = 0; i < n; i++) {
            const double own = error && error[i] > 0.0 ? error[i] : 0.0, variance = own * own + between * between;
            const double weight = variance > 0.0 ? 1.0 / variance : 1.0;
            const double x = riddle_log(pressure[i] / reference), y = riddle_log(value[i]);
            if (pass == 0) l.weights += weight, l.mean_x += weight * x, l.mean_y += weight * y;
            else if (pass == 1)
                l.sxx += weight * (x - l.mean_x) * (x - l.mean_x), sxy += weight * (x - l.mean_x) * (y - l.mean_y);
            else {
                const double rest = y - l.mean_y - l.slope * (x - l.mean_x);
                l.squares += weight * rest * rest;
            }
            if (i + 1 < n) continue;
            if (pass == 0) l.mean_x /= l.weights, l.mean_y /= l.weights;
            else if (pass == 1) l.slope = sxy / l.sxx;
        }
    return l;
}

/* Returns the standard deviation between runs with which the weighted squares are what chance makes of them; 0 where the runs' errors are
   enough. */
static inline double filtration__between(size_t n, const double *pressure, const double *value, const double *error,
                                         double reference) {
    const double freedom = (double)n - 2.0;
    double low = 0.0, high = 1e-12;
    const filtration__law none = filtration__law_of(n, pressure, value, error, reference, 0.0);
    int known = 1; /* are all runs' errors known? */
    for (size_t i = 0; i < n; i++) known &= error && error[i] > 0.0;
    if (known && none.squares <= freedom) return 0.0;
    while (high < 1e6 && filtration__law_of(n, pressure, value, error, reference, high).squares > freedom)
        low = high, high *= 2.0;
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (filtration__law_of(n, pressure, value, error, reference, middle).squares > freedom) low = middle;
        else high = middle;
    }
    return high;
}

FILTRATION_API filtration_status filtration_value_at_pressure(const filtration_compressibility *fit, double pressure,
                                                              filtration_estimate *value) {
    if (!value) return FILTRATION_BAD_ARGUMENT;
    *value = filtration__estimate((double)NAN, (double)NAN, (double)NAN);
    if (!fit || !filtration__is_positive(pressure) || !filtration__is_positive(fit->reference))
        return FILTRATION_BAD_ARGUMENT;
    const double x = riddle_log(pressure / fit->reference), at = fit->at_reference.value,
                 of_level = fit->at_reference.error / at;
    const double variance =
        of_level * of_level + 2.0 * x * fit->covariance + x * x * fit->exponent.error * fit->exponent.error;
    const double error = variance > 0.0 ? sqrt(variance) : variance == variance ? 0.0 : (double)NAN;
    value->value = filtration_power_law(at, fit->exponent.value, pressure, fit->reference);
    value->error = error * value->value;
    value->low = value->value * riddle_exp(-fit->student * error),
    value->high = value->value * riddle_exp(fit->student * error);
    return filtration__is_finite(value->value) ? FILTRATION_OK : FILTRATION_NO_SOLUTION;
}

FILTRATION_API filtration_status filtration_fit_compressibility(size_t runs, const double *pressure,
                                                                const double *value, const double *error,
                                                                double reference, double confidence,
                                                                filtration_compressibility *fit) {
    if (!fit) return FILTRATION_BAD_ARGUMENT;
    memset(fit, 0, sizeof *fit);
    fit->exponent = fit->at_reference = filtration__estimate((double)NAN, (double)NAN, (double)NAN);
    fit->covariance = fit->between = fit->freedom = fit->student = fit->lowest = fit->highest = (double)NAN;
    fit->reference = fit->confidence = (double)NAN;
    if (!filtration__is_positive(reference) || !(confidence > 0.0 && confidence < 1.0)) return FILTRATION_BAD_ARGUMENT;
    if (runs < 2) return FILTRATION_FEW_DATA;
    if (!pressure || !value) return FILTRATION_BAD_ARGUMENT;
    double lowest = HUGE_VAL, highest = 0.0;
    for (size_t i = 0; i < runs; i++) {
        if (!filtration__is_positive(pressure[i]) || !filtration__is_positive(value[i])) return FILTRATION_BAD_ARGUMENT;
        if (error && (error[i] < 0.0 || error[i] > FILTRATION__LARGEST)) return FILTRATION_BAD_ARGUMENT;
        if (pressure[i] < lowest) lowest = pressure[i];
        if (pressure[i] > highest) highest = pressure[i];
    }
    if (!(highest > lowest * (1.0 + 1e-9))) return FILTRATION_NO_SOLUTION;
    const double freedom = (double)runs - 2.0;
    const double between = freedom > 0.0 ? filtration__between(runs, pressure, value, error, reference) : 0.0;
    const filtration__law l = filtration__law_of(runs, pressure, value, error, reference, between);
    const double student = freedom > 0.0 ? filtration_student(confidence, freedom) : (double)NAN;
    const double of_slope = sqrt(1.0 / l.sxx), of_level = sqrt(1.0 / l.weights + l.mean_x * l.mean_x / l.sxx);
    const double at = riddle_exp(l.mean_y - l.slope * l.mean_x);
    if (!filtration__is_finite(l.slope) || !filtration__is_positive(at)) return FILTRATION_NO_SOLUTION;
    fit->reference = reference, fit->confidence = confidence, fit->runs = runs, fit->lowest = lowest,
    fit->highest = highest;
    fit->freedom = freedom, fit->student = student;
    fit->exponent = filtration__estimate(l.slope, freedom > 0.0 ? of_slope : (double)NAN, student);
    fit->at_reference = filtration__estimate(at, freedom > 0.0 ? at * of_level : (double)NAN, student);
    fit->covariance = freedom > 0.0 ? -l.mean_x / l.sxx : (double)NAN;
    fit->between = freedom > 0.0 ? between : (double)NAN;
    filtration_estimate there = fit->at_reference;
    if (freedom > 0.0) filtration_value_at_pressure(fit, reference, &there);
    fit->at_reference = there;
    return FILTRATION_OK;
}
