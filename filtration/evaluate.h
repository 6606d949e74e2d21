/* evaluate.h: a measured filter curve: the straight line of t / V over V, its longest straight stretch, intervals, prediction.
   Relies on base.h, process_api.h, process_laws.h, process.h.
   May be changed here alone: how a stretch is searched. */

FILTRATION_API const char *filtration_remark_text(unsigned remark) {
#define FILTRATION__REMARK_TEXT(name, bit, text)                                                                                           \
    if (remark == bit) return text;
    FILTRATION_REMARKS(FILTRATION__REMARK_TEXT)
    return remark == 0 ? "nothing to remark" : "unknown remark";
}

enum { FILTRATION__CURVE_COOKIE = 0x46435631 };
#define FILTRATION__ROUNDING 1e-12 /* share of t / V below which bend and scatter are of the numbers, not of the filter */

FILTRATION_API filtration_curve_def filtration_curve_default_def(void) {
    filtration_curve_def d;
    memset(&d, 0, sizeof d);
    d.cookie = FILTRATION__CURVE_COOKIE;
    d.pressure = 1e5;
    d.viscosity = 1e-3;
    d.area = 2e-3;
    d.cake_ratio = (double)NAN;
    d.last_volume = HUGE_VAL;
    d.automatic = 1;
    d.least_readings = 6;
    d.bend_level = 0.1;
    d.tolerance = 0.005;
    d.confidence = 0.95;
    return d;
}

static inline int filtration__is_error(double x) { return x >= 0.0 && filtration__is_finite(x); }
static inline int filtration__is_positive(double x) { return x > 0.0 && filtration__is_finite(x); }

FILTRATION_API filtration_status filtration_curve_check_def(const filtration_curve_def *d, const char **field) {
    const char *bad = NULL;
    if (!d) bad = "def";
    else if (d->cookie != FILTRATION__CURVE_COOKIE) bad = "cookie";
    else if (!filtration__is_positive(d->pressure)) bad = "pressure";
    else if (!filtration__is_positive(d->viscosity)) bad = "viscosity";
    else if (!filtration__is_positive(d->area)) bad = "area";
    else if (d->cake_ratio == d->cake_ratio && !filtration__is_positive(d->cake_ratio)) bad = "cake_ratio";
    else if (!filtration__is_error(d->pressure_error)) bad = "pressure_error";
    else if (!filtration__is_error(d->viscosity_error)) bad = "viscosity_error";
    else if (!filtration__is_error(d->area_error)) bad = "area_error";
    else if (!filtration__is_error(d->cake_ratio_error)) bad = "cake_ratio_error";
    else if (!filtration__is_error(d->time_error)) bad = "time_error";
    else if (!filtration__is_error(d->volume_error)) bad = "volume_error";
    else if (!filtration__is_finite(d->start_time)) bad = "start_time";
    else if (!filtration__is_error(d->start_volume)) bad = "start_volume";
    else if (!(d->first_volume >= 0.0)) bad = "first_volume";
    else if (!(d->last_volume > d->first_volume)) bad = "last_volume";
    else if (d->automatic != 0 && d->automatic != 1) bad = "automatic";
    else if (d->least_readings < 5) bad = "least_readings";
    else if (!(d->bend_level > 0.0 && d->bend_level <= 1.0)) bad = "bend_level";
    else if (!(d->tolerance >= 0.0)) bad = "tolerance";
    else if (!(d->confidence > 0.0 && d->confidence < 1.0)) bad = "confidence";
    if (field) *field = bad;
    return bad ? FILTRATION_BAD_DEF : FILTRATION_OK;
}

/* The readings, and the scales that keep sums in the range of doubles. */
typedef struct filtration__readings {
    const filtration_curve_def *def;
    const double *time, *volume;
    double x_scale, y_scale;
} filtration__readings;

/* Computes the abscissa V + V1, the ordinate (t - t1) / (V - V1), both scaled, and the weight 1 / variance of reading i. Returns 0 if it is
   left out. */
static inline int filtration__reading(const filtration__readings *r, size_t i, double *x, double *y, double *weight) {
    const filtration_curve_def *d = r->def;
    const double t = r->time[i] - d->start_time, V = r->volume[i] - d->start_volume;
    if (!(t > 0.0 && V > 0.0 && r->volume[i] >= d->first_volume && r->volume[i] <= d->last_volume)) return 0;
    *x = (r->volume[i] + d->start_volume) / r->x_scale;
    *y = t / V / r->y_scale;
    *weight = 1.0;
    if (d->time_error > 0.0 || d->volume_error > 0.0) {
        const double u = V / r->x_scale, in_time = d->time_error / r->y_scale / r->x_scale, in_volume = d->volume_error / r->x_scale * *y;
        *weight = u * u / (in_time * in_time + in_volume * in_volume);
    }
    return 1;
}

/* Weighted straight line, and the parabola and the cubic that are orthogonal to it. x' = x - mean_x. */
typedef struct filtration__line {
    size_t n;
    double weights, mean_x, mean_y, sxx, sxy, syy, low, high; /* low, high: range of x */
    double curvature[2];                                      /* factors of the parabola x'^2 ..., of the cubic x'^3 ... */
    double explained;                                         /* sum of weighted squares that the two explain */
    double squares, neighbours;                               /* sum of weighted squared residuals; of products of neighbouring ones */
} filtration__line;

/* Computes means and moments for the straight line. Returns the sum of weight x'^3. */
static inline double filtration__fit_line(const filtration__readings *r, size_t first, size_t last, filtration__line *line) {
    double x, y, weight, cubes = 0.0;
    memset(line, 0, sizeof *line);
    line->low = HUGE_VAL, line->high = -HUGE_VAL;
    for (size_t i = first; i <= last; i++) {
        if (!filtration__reading(r, i, &x, &y, &weight)) continue;
        line->n++;
        line->weights += weight, line->mean_x += weight * x, line->mean_y += weight * y;
        if (x < line->low) line->low = x;
        if (x > line->high) line->high = x;
    }
    line->mean_x /= line->weights, line->mean_y /= line->weights;
    for (size_t i = first; i <= last; i++) {
        if (!filtration__reading(r, i, &x, &y, &weight)) continue;
        x -= line->mean_x, y -= line->mean_y;
        line->sxx += weight * x * x, line->sxy += weight * x * y, line->syy += weight * y * y;
        cubes += weight * x * x * x;
    }
    return cubes;
}

/* Fits the line, its residuals and, by the three-term recurrence of orthogonal polynomials (Forsythe 1957), the parabola and the cubic. */
static inline void filtration__fit(const filtration__readings *r, size_t first, size_t last, filtration__line *line) {
    const double skew = filtration__fit_line(r, first, last, line) / line->sxx, spread = line->sxx / line->weights;
    double x, y, weight, before = 0.0, s22 = 0.0, s33 = 0.0, in_2 = 0.0, in_3 = 0.0, shift = 0.0;
    for (size_t i = first; i <= last; i++) {
        if (!filtration__reading(r, i, &x, &y, &weight)) continue;
        x -= line->mean_x, y -= line->mean_y;
        const double parabola = (x - skew) * x - spread, residual = sqrt(weight) * (y - line->sxy / line->sxx * x);
        s22 += weight * parabola * parabola, in_2 += weight * parabola * y, shift += weight * x * parabola * parabola;
        line->squares += residual * residual, line->neighbours += residual * before;
        before = residual;
    }
    for (size_t i = first; i <= last; i++) {
        if (!filtration__reading(r, i, &x, &y, &weight)) continue;
        x -= line->mean_x, y -= line->mean_y;
        const double cubic = (x - shift / s22) * ((x - skew) * x - spread) - s22 / line->sxx * x;
        s33 += weight * cubic * cubic, in_3 += weight * cubic * y;
    }
    line->curvature[0] = s22 > 0.0 ? in_2 / s22 : 0.0, line->curvature[1] = s33 > 0.0 ? in_3 / s33 : 0.0;
    line->explained = line->curvature[0] * in_2 + line->curvature[1] * in_3;
}

/* Returns about the largest departure of parabola and cubic from the line, over the mean ordinate. */
static inline double filtration__bend(const filtration__line *line) {
    const double half = 0.5 * (line->high - line->low);
    return (fabs(line->curvature[0]) + fabs(line->curvature[1]) * half) * half * half / line->mean_y;
}

/* Returns whether a stretch is straight: parabola and cubic explain no more than chance would (F test with 2 and n - 4 degrees of freedom),
   or no more than the tolerance. A parabola alone would miss an S-shaped curve (flat, steep, less steep). */
static inline int filtration__is_straight(const filtration__readings *r, const filtration__line *line) {
    if (!(line->sxx > 0.0)) return 0;
    if (filtration__bend(line) <= r->def->tolerance + FILTRATION__ROUNDING) return 1;
    const double freedom = (double)line->n - 4.0, rest = line->squares - line->explained;
    if (!(rest > 0.0 && freedom > 0.0)) return 0;
    return riddle_exp(-0.5 * freedom * riddle_log1p(line->explained / rest)) >= r->def->bend_level;
}

/* Finds the straight stretch over the widest range of volumes, among up to `grid` starts and ends; first and last stay if there is none.
   Then cuts off a fifth at an end beyond which the curve bends: the test passes readings whose bend is hidden by scatter, and they would
   bias the line (without the cut, 95 % intervals hold in 83 % of trials; tests/test_filtration_process.c). */
static inline void filtration__longest_straight(const filtration__readings *r, size_t *first_reading, size_t *last_reading) {
    const size_t first = *first_reading, last = *last_reading, readings = last - first + 1, least = r->def->least_readings;
    size_t grid = readings <= 20000 ? 48 : 12;
    double widest = 0.0;
    if (grid > readings) grid = readings;
    for (size_t a = 0; a < grid; a++) {
        const size_t from = first + a * readings / grid;
        for (size_t b = 0; b < grid; b++) {
            const size_t to = last - b * readings / grid;
            if (to < from + least - 1 || to > last || !(fabs(r->volume[to] - r->volume[from]) > widest)) break;
            filtration__line line;
            filtration__fit(r, from, to, &line);
            if (line.n < least || !filtration__is_straight(r, &line)) continue;
            widest = fabs(r->volume[to] - r->volume[from]);
            *first_reading = from, *last_reading = to;
        }
    }
    const size_t guard = (*last_reading - *first_reading) / 5;
    if (*first_reading > first && *last_reading - *first_reading + 1 >= guard + least) *first_reading += guard;
    if (*last_reading < last && *last_reading - *first_reading + 1 >= guard + least) *last_reading -= guard;
}

static inline filtration_estimate filtration__estimate(double value, double error, double student) {
    filtration_estimate e;
    e.value = value, e.error = error;
    e.low = value - student * error, e.high = value + student * error;
    return e;
}

/* Returns an estimate that is `factor` times another one. The factor has a relative standard error of its own, known well (Welch 1947 and
   Satterthwaite 1946 for the degrees of freedom). */
static inline filtration_estimate filtration__times(filtration_estimate e, double factor, double relative, double confidence,
                                                    double freedom) {
    const double value = factor * e.value, of_fit = fabs(factor) * e.error, of_factor = fabs(value) * relative;
    const double larger = of_fit > of_factor ? of_fit : of_factor, smaller = of_fit > of_factor ? of_factor : of_fit;
    const double error = larger > 0.0 ? larger * sqrt(1.0 + (smaller / larger) * (smaller / larger)) : larger;
    const double ratio = of_fit > 0.0 ? error / of_fit : 1.0;
    return filtration__estimate(value, error, filtration_student(confidence, freedom * ratio * ratio * ratio * ratio));
}

static inline void filtration__clear_curve(filtration_curve *c) {
    memset(c, 0, sizeof *c);
    c->slope = c->intercept = c->product = c->cake = c->medium = filtration__estimate((double)NAN, (double)NAN, (double)NAN);
    c->covariance = c->freedom = c->student = c->scatter = c->r2 = c->bend = c->correlation = (double)NAN;
    c->pressure = c->viscosity = c->area = c->confidence = c->smallest = c->largest = (double)NAN;
}

/* Returns whether the volume runs backwards after the start, by more than readings scatter. */
static inline int filtration__falls(const filtration__readings *r, size_t n) {
    double largest = 0.0, highest = 0.0;
    for (size_t i = 0; i < n; i++)
        if (r->time[i] > r->def->start_time && r->volume[i] > largest) largest = r->volume[i];
    const double scatter = 0.02 * largest + 6.0 * r->def->volume_error;
    for (size_t i = 0; i < n; i++) {
        if (!(r->time[i] > r->def->start_time)) continue;
        if (r->volume[i] > highest) highest = r->volume[i];
        if (highest - r->volume[i] > scatter) return 1;
    }
    return 0;
}

/* Checks the readings; first and last: the outermost ones that count. */
static inline filtration_status filtration__take(filtration__readings *r, size_t n, size_t *first, size_t *last, size_t *count) {
    double x, y, weight;
    r->x_scale = r->y_scale = 1.0;
    *count = 0;
    double largest_x = 0.0, largest_y = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double t = r->time[i], V = r->volume[i];
        if (!(filtration__is_finite(t) && filtration__is_error(V)) || (i > 0 && !(t >= r->time[i - 1]))) return FILTRATION_BAD_ARGUMENT;
        if (!filtration__reading(r, i, &x, &y, &weight)) continue;
        if (*count == 0) *first = i;
        *last = i;
        ++*count;
        if (x > largest_x) largest_x = x;
        if (y > largest_y) largest_y = y;
    }
    if (filtration__falls(r, n)) return FILTRATION_BAD_ARGUMENT;
    if (*count < r->def->least_readings) return FILTRATION_FEW_DATA;
    r->x_scale = largest_x, r->y_scale = largest_y;
    return filtration__is_positive(largest_x) && filtration__is_positive(largest_y) ? FILTRATION_OK : FILTRATION_NO_SOLUTION;
}

/* Computes the intervals of the line. They are widened if neighbouring residuals correlate: m readings then count as m (1 - r) / (1 +
   r). */
static inline void filtration__intervals(const filtration__readings *r, const filtration__line *line, filtration_curve *c) {
    const filtration_curve_def *d = r->def;
    const double m = (double)line->n, slope = line->sxy / line->sxx, y_over_x = r->y_scale / r->x_scale;
    double variance = line->squares / (m - 2.0);
    c->used = line->n;
    c->freedom = m - 2.0;
    c->correlation = line->squares > 0.0 ? line->neighbours / line->squares : 0.0;
    c->scatter = sqrt(variance / (line->weights / m)) / line->mean_y;
    c->r2 = line->syy > 0.0 ? 1.0 - line->squares / line->syy : 0.0;
    c->bend = filtration__bend(line);
    if (c->correlation > 1.645 / sqrt(m) && c->scatter > FILTRATION__ROUNDING) {
        const double inflation = (1.0 + c->correlation) / (1.0 - c->correlation);
        variance *= inflation;
        c->freedom = m / inflation - 2.0 > 1.0 ? m / inflation - 2.0 : 1.0;
        c->remarks |= FILTRATION_REMARK_CORRELATED;
    }
    c->student = filtration_student(d->confidence, c->freedom);
    const double of_slope = sqrt(variance / line->sxx);
    const double of_intercept = sqrt(variance * (1.0 / line->weights + line->mean_x * line->mean_x / line->sxx));
    c->slope = filtration__estimate(slope * y_over_x, of_slope * y_over_x, c->student);
    c->intercept = filtration__estimate((line->mean_y - slope * line->mean_x) * r->y_scale, of_intercept * r->y_scale, c->student);
    c->covariance = -variance * line->mean_x / line->sxx * r->y_scale * y_over_x;
}

static inline void filtration__resistances(const filtration_curve_def *d, filtration_curve *c) {
    const double p = d->pressure_error, v = d->viscosity_error, a = d->area_error, k = d->cake_ratio_error;
    const double of_duty = p * p + v * v;
    c->product = filtration__times(c->slope, filtration_product_of_slope(1.0, d->pressure, d->viscosity, d->area),
                                   sqrt(of_duty + 4.0 * a * a), d->confidence, c->freedom);
    c->cake = filtration__times(c->slope, filtration_product_of_slope(1.0, d->pressure, d->viscosity, d->area) / d->cake_ratio,
                                sqrt(of_duty + 4.0 * a * a + k * k), d->confidence, c->freedom);
    c->medium = filtration__times(c->intercept, filtration_medium_of_intercept(1.0, d->pressure, d->viscosity, d->area),
                                  sqrt(of_duty + a * a), d->confidence, c->freedom);
    c->pressure = d->pressure, c->viscosity = d->viscosity, c->area = d->area, c->confidence = d->confidence;
}

FILTRATION_API filtration_status filtration_evaluate(const filtration_curve_def *def, size_t n, const double *time, const double *volume,
                                                     filtration_curve *result) {
    size_t first = 0, last = 0, count = 0;
    filtration__line line;
    if (!result) return FILTRATION_BAD_ARGUMENT;
    filtration__clear_curve(result);
    if (filtration_curve_check_def(def, NULL) != FILTRATION_OK) return FILTRATION_BAD_DEF;
    if (n > 0 && (!time || !volume)) return FILTRATION_BAD_ARGUMENT;
    filtration__readings r;
    r.def = def, r.time = time, r.volume = volume;
    filtration_status status = filtration__take(&r, n, &first, &last, &count);
    if (status != FILTRATION_OK) return status;
    if (def->automatic) filtration__longest_straight(&r, &first, &last);
    filtration__fit(&r, first, last, &line);
    if (!(line.sxx > 0.0 && filtration__is_finite(line.sxy) && filtration__is_finite(line.squares))) return FILTRATION_NO_SOLUTION;
    if (!filtration__is_straight(&r, &line)) result->remarks |= FILTRATION_REMARK_BENT;
    result->first = first, result->last = last;
    result->smallest = volume[first], result->largest = volume[last];
    filtration__intervals(&r, &line, result);
    filtration__resistances(def, result);
    if (!(result->slope.low > 0.0)) result->remarks |= FILTRATION_REMARK_SLOPE;
    if (result->intercept.value < 0.0) result->remarks |= FILTRATION_REMARK_MEDIUM;
    const double all = result->product.error + result->medium.error;
    if (filtration__is_finite(all) && filtration__is_finite(result->product.value)) return FILTRATION_OK;
    filtration__clear_curve(result);
    return FILTRATION_NO_SOLUTION;
}

FILTRATION_API filtration_status filtration_evaluate_clean(const filtration_curve_def *def, size_t n, const double *time,
                                                           const double *volume, double last_volume, filtration_estimate *medium) {
    size_t first = 0, last = 0, count = 0;
    filtration__line line;
    if (!medium) return FILTRATION_BAD_ARGUMENT;
    *medium = filtration__estimate((double)NAN, (double)NAN, (double)NAN);
    if (!(last_volume > 0.0)) return FILTRATION_BAD_ARGUMENT;
    if (filtration_curve_check_def(def, NULL) != FILTRATION_OK) return FILTRATION_BAD_DEF;
    if (n > 0 && (!time || !volume)) return FILTRATION_BAD_ARGUMENT;
    filtration_curve_def clean = *def;
    clean.first_volume = 0.0, clean.last_volume = last_volume;
    filtration__readings r;
    r.def = &clean, r.time = time, r.volume = volume;
    filtration_status status = filtration__take(&r, n, &first, &last, &count);
    if (status != FILTRATION_OK) return status;
    filtration__fit(&r, first, last, &line);
    const double freedom = (double)line.n - 1.0, a = def->area_error, p = def->pressure_error, v = def->viscosity_error;
    const double error = sqrt(line.syy / freedom / line.weights);
    if (!(filtration__is_finite(error) && line.mean_y > 0.0)) return FILTRATION_NO_SOLUTION;
    const filtration_estimate mean = filtration__estimate(line.mean_y * r.y_scale, error * r.y_scale, 1.0);
    const filtration_estimate found = filtration__times(mean, filtration_medium_of_intercept(1.0, def->pressure, def->viscosity, def->area),
                                                        sqrt(p * p + v * v + a * a), def->confidence, freedom);
    if (!(filtration__is_finite(found.value) && filtration__is_finite(found.error))) return FILTRATION_NO_SOLUTION;
    *medium = found;
    return FILTRATION_OK;
}

FILTRATION_API filtration_status filtration_predict(const filtration_curve *curve, double pressure, double area, double compressibility,
                                                    double V, filtration_estimate *time) {
    if (!time) return FILTRATION_BAD_ARGUMENT;
    *time = filtration__estimate((double)NAN, (double)NAN, (double)NAN);
    if (!curve || !filtration__is_positive(pressure) || !filtration__is_positive(area) || !filtration__is_error(V) ||
        !(compressibility >= 0.0 && compressibility < 1.0) || !filtration__is_positive(curve->pressure))
        return FILTRATION_BAD_ARGUMENT;
    const double p = curve->pressure / pressure, a = curve->area / area;
    const double square = V * V * a * a * p * riddle_pow(pressure / curve->pressure, compressibility), linear = V * a * p;
    const double variance = square * square * curve->slope.error * curve->slope.error +
                            linear * linear * curve->intercept.error * curve->intercept.error + 2.0 * square * linear * curve->covariance;
    *time = filtration__estimate(square * curve->slope.value + linear * curve->intercept.value, sqrt(variance > 0.0 ? variance : 0.0),
                                 filtration_student(curve->confidence, curve->freedom));
    return filtration__is_finite(time->value) && filtration__is_finite(time->error) ? FILTRATION_OK : FILTRATION_NO_SOLUTION;
}

FILTRATION_API unsigned filtration_outside(const filtration_curve *curve, double pressure, double area, double V) {
    unsigned flags = FILTRATION_OUTSIDE_NOTHING;
    if (!curve) return flags;
    const double as_measured = V * (curve->area / area), other = pressure / curve->pressure;
    if (!(as_measured <= 1.01 * curve->largest)) flags |= FILTRATION_OUTSIDE_MORE;
    if (!(as_measured >= 0.99 * curve->smallest)) flags |= FILTRATION_OUTSIDE_LESS;
    if (!(other >= 0.99 && other <= 1.01)) flags |= FILTRATION_OUTSIDE_PRESSURE;
    return flags;
}

FILTRATION_API const char *filtration_outside_text(unsigned flag) {
#define FILTRATION__OUTSIDE_TEXT(name, bit, text)                                                                                          \
    if (flag == bit) return text;
    FILTRATION_OUTSIDES(FILTRATION__OUTSIDE_TEXT)
    return "unknown flag";
}
