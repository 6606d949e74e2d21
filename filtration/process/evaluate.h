/* A measured filter curve: the straight line of t / V over V, its longest straight stretch, intervals, prediction. */
#pragma once
#include "process_line.h"

FILTRATION_API const char *filtration_remark_text(unsigned remark) {
#define FILTRATION__REMARK_TEXT(name, bit, text)                                                                       \
    if (remark == bit) return text;
    FILTRATION_REMARKS(FILTRATION__REMARK_TEXT)
    return remark == 0 ? "nothing to remark" : "unknown remark";
}

enum { FILTRATION__CURVE_COOKIE = 0x46435632 };

FILTRATION_API filtration_curve_def filtration_curve_default_def(void) {
    filtration_curve_def d;
    memset(&d, 0, sizeof d);
    d.cookie = FILTRATION__CURVE_COOKIE;
    d.pressure = 1e5;
    d.viscosity = 1e-3;
    d.area = 2e-3;
    d.cake_ratio = d.solids = (double)NAN;
    d.last_volume = HUGE_VAL;
    d.automatic = 1;
    d.least_readings = 6;
    d.bend_level = 0.1;
    d.tolerance = 0.005;
    d.confidence = 0.95;
    return d;
}

static inline int filtration__is_error(double x) { return x >= 0.0 && filtration__is_finite(x); }
FILTRATION_API filtration_status filtration_curve_check_def(const filtration_curve_def *d, const char **field) {
    const char *bad = NULL;
    if (!d) bad = "def";
    else if (d->cookie != FILTRATION__CURVE_COOKIE) bad = "cookie";
    else if (!filtration__is_positive(d->pressure)) bad = "pressure";
    else if (!filtration__is_positive(d->viscosity)) bad = "viscosity";
    else if (!filtration__is_positive(d->area)) bad = "area";
    else if (d->cake_ratio == d->cake_ratio && !filtration__is_positive(d->cake_ratio)) bad = "cake_ratio";
    else if (d->solids == d->solids && !filtration__is_positive(d->solids)) bad = "solids";
    else if (!filtration__is_error(d->solids_error)) bad = "solids_error";
    else if (!filtration__is_error(d->pressure_error)) bad = "pressure_error";
    else if (!filtration__is_error(d->viscosity_error)) bad = "viscosity_error";
    else if (!filtration__is_error(d->area_error)) bad = "area_error";
    else if (!filtration__is_error(d->cake_ratio_error)) bad = "cake_ratio_error";
    else if (!filtration__is_error(d->time_error)) bad = "time_error";
    else if (!filtration__is_error(d->volume_error)) bad = "volume_error";
    else if (!filtration__is_error(d->drift_error)) bad = "drift_error";
    else if (d->independent != 0 && d->independent != 1) bad = "independent";
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

/* How far the readings of a stretch bend: the departure of a parabola and a cubic from the line, over the mean
   ordinate; the probability that chance alone would bend it as much (F test with 2 and n - 4 degrees of freedom), its
   mean over the kinds of scatter by their likelihoods, because few readings over a wide range of volumes always have
   one kind by which they bend; size and the drift of the balance that would bend it so, in shares of the end, are for
   the likeliest kind. A parabola alone would miss an S-shaped curve (flat, steep, less steep). */
typedef struct filtration__bend {
    double size, chance, drift;
} filtration__bend;

#define FILTRATION__CERTAIN                                                                                            \
    0.2 /* factor of the level: below it, a bend is not attributed to chance even where all readings are to count */

static inline filtration__bend filtration__find_bend(const filtration__readings *r, size_t first, size_t last,
                                                     const filtration__line *line) {
    filtration__bend bend = {0.0, 1.0, 0.0};
    filtration__kind kind, best = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, {0.0, 0.0}, 0.0, 0.0, 0.0, {0.0, 0.0}};
    double of_weight[FILTRATION__WEIGHTS], most = -HUGE_VAL, sum = 0.0, chance = 0.0;
    if (line->n < 6) return bend; /* too few readings to tell a bend */
    filtration__fill_priors(r, first, last, line, of_weight);
    for (int k = 0; k < FILTRATION__FITS; k++) {
        const filtration__roughness *rough = &filtration__roughs[k % FILTRATION__ROUGHS];
        if (!filtration__is_thought_of(r->def, k) || !rough->for_bend) continue;
        filtration__fit_kind(r, first, last, line, 2, k / FILTRATION__ROUGHS, rough, 1, &kind);
        kind.bent_likelihood += riddle_log(of_weight[k / FILTRATION__ROUGHS]);
        if (k == 0 || kind.bent_likelihood > best.bent_likelihood) best = kind;
        if (kind.bent_likelihood > most) {
            const double less = riddle_exp(most - kind.bent_likelihood);
            sum *= less, chance *= less, most = kind.bent_likelihood;
        }
        const double share = riddle_exp(kind.bent_likelihood - most);
        const double explained = (kind.squares - kind.bent_squares) / kind.bent_squares;
        sum += share;
        chance += share * riddle_exp(-0.5 * ((double)line->n - 4.0) * riddle_log1p(explained > 0.0 ? explained : 0.0));
    }
    bend.size = (fabs(best.coefficient[0]) * 2.0 / 3.0 + fabs(best.coefficient[1]) * 0.4) / line->mean_y;
    bend.chance = sum > 0.0 ? chance / sum : 1.0;
    bend.drift = fabs(best.drift);
    return bend;
}

/* Returns whether a stretch is straight: it bends no more than chance would bend it, or than the tolerance. level: the
   smallest probability. */
static inline int filtration__is_straight(const filtration__readings *r, const filtration__line *line,
                                          const filtration__bend *bend, double level) {
    return line->sxx > 0.0 && (bend->chance >= level || bend->size <= r->def->tolerance + FILTRATION__ROUNDING);
}

/* Finds the straight stretch over the widest range of volumes, among up to `grid` starts and ends. If there is none,
   first and last stay. Then cuts off a fifth at an end beyond which the curve bends: the test admits readings whose
   bend is hidden by scatter, and they would bias the line (without the cut, 95 % intervals hold in 83 % of trials;
   tests/test_filtration_process.c). */
static inline void filtration__longest_straight(const filtration__readings *r, size_t *first_reading,
                                                size_t *last_reading) {
    const size_t first = *first_reading, last = *last_reading, readings = last - first + 1,
                 least = r->def->least_readings;
    size_t grid = readings <= 400 ? 48 : readings <= 20000 ? 24 : 12;
    double widest = 0.0;
    if (grid > readings) grid = readings;
    for (size_t a = 0; a < grid; a++) {
        const size_t from = first + a * readings / grid;
        for (size_t b = 0; b < grid; b++) {
            const size_t to = last - b * readings / grid;
            if (to < from + least - 1 || to > last || !(fabs(r->volume[to] - r->volume[from]) > widest)) break;
            filtration__line line;
            filtration__plain_line(r, from, to, &line);
            if (line.n < least) continue;
            const filtration__bend bend = filtration__find_bend(r, from, to, &line);
            if (!filtration__is_straight(r, &line, &bend, r->def->bend_level)) continue;
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

/* Returns an estimate that is `factor` times another one. The factor has its own relative standard error, which is
   known well (Welch 1947 and Satterthwaite 1946 for the degrees of freedom). */
static inline filtration_estimate filtration__times(filtration_estimate e, double factor, double relative,
                                                    double confidence, double freedom) {
    const double value = factor * e.value, of_fit = fabs(factor) * e.error, of_factor = fabs(value) * relative;
    const double larger = of_fit > of_factor ? of_fit : of_factor, smaller = of_fit > of_factor ? of_factor : of_fit;
    const double error = larger > 0.0 ? larger * sqrt(1.0 + (smaller / larger) * (smaller / larger)) : larger;
    const double ratio = of_fit > 0.0 ? error / of_fit : 1.0;
    return filtration__estimate(value, error, filtration_student(confidence, freedom * ratio * ratio * ratio * ratio));
}

static inline void filtration__clear_curve(filtration_curve *c) {
    memset(c, 0, sizeof *c);
    c->slope = c->intercept = c->product = c->cake = c->by_mass = c->medium =
        filtration__estimate((double)NAN, (double)NAN, (double)NAN);
    c->covariance = c->freedom = c->student = c->scatter = c->r2 = c->bend = c->correlation = (double)NAN;
    c->pressure = c->viscosity = c->area = c->confidence = c->smallest = c->largest = (double)NAN;
}

/* Returns whether the volume falls after the start, by more than readings scatter. */
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

/* Checks the readings. least: how many are needed; first and last: the outermost ones that count. */
static inline filtration_status filtration__take(filtration__readings *r, size_t n, size_t least, size_t *first,
                                                 size_t *last, size_t *count) {
    double x, y, u;
    r->x_scale = r->y_scale = 1.0;
    *count = 0;
    double largest_x = 0.0, largest_y = 0.0;
    for (size_t i = 0; i < n; i++) {
        const double t = r->time[i], V = r->volume[i];
        if (!(filtration__is_finite(t) && filtration__is_error(V)) || (i > 0 && !(t >= r->time[i - 1])))
            return FILTRATION_BAD_ARGUMENT;
        if (!filtration__reading(r, i, &x, &y, &u)) continue;
        if (*count == 0) *first = i;
        *last = i;
        ++*count;
        if (x > largest_x) largest_x = x;
        if (y > largest_y) largest_y = y;
    }
    if (filtration__falls(r, n)) return FILTRATION_BAD_ARGUMENT;
    if (*count < least) return FILTRATION_FEW_DATA;
    r->x_scale = largest_x, r->y_scale = largest_y;
    return filtration__is_positive(largest_x) && filtration__is_positive(largest_y) ? FILTRATION_OK
                                                                                    : FILTRATION_NO_SOLUTION;
}

/* Computes the line and its intervals. Their covariance makes the interval at the mean volume right, too. */
static inline void filtration__intervals(const filtration__readings *r, size_t first, size_t last,
                                         const filtration__line *line, const filtration__bend *bend,
                                         filtration_curve *c) {
    const double y_over_x = r->y_scale / r->x_scale, mean = line->mean_x;
    double x, y, u, squares = 0.0, all = 0.0, mean_y = 0.0;
    filtration__mixture m;
    filtration__mix(r, first, last, line, 2, &m);
    const double slope = line->slope + m.slope, level = line->mean_y + m.level, n = (double)line->n;
    for (size_t i = first; i <= last; i++)
        if (filtration__reading(r, i, &x, &y, &u)) mean_y += y / n;
    for (size_t i = first; i <= last; i++) {
        if (!filtration__reading(r, i, &x, &y, &u)) continue;
        const double rest = y - level - slope * (x - mean);
        squares += rest * rest, all += (y - mean_y) * (y - mean_y);
    }
    c->used = line->n;
    c->freedom = m.freedom, c->student = m.student;
    c->scatter = sqrt(squares / m.freedom) / mean_y;
    c->r2 = all > 0.0 ? 1.0 - squares / all : 0.0;
    c->bend = bend->size;
    c->correlation = c->scatter > FILTRATION__ROUNDING ? m.rough : 0.0;
    if (c->correlation > 0.5) c->remarks |= FILTRATION_REMARK_CORRELATED;
    if (n < FILTRATION__FEW && !r->def->independent && c->scatter > FILTRATION__ROUNDING)
        c->remarks |= FILTRATION_REMARK_FEW;
    const double certain = FILTRATION__CERTAIN * r->def->bend_level;
    if (bend->chance < certain && bend->size > FILTRATION__ROUNDING) { /* significant, though within the tolerance */
        c->remarks |= FILTRATION_REMARK_DRIFT;
        if (bend->drift > m.drift) m.drift = bend->drift;
    }
    if (!filtration__is_straight(r, line, bend, certain)) {
        c->remarks |= FILTRATION_REMARK_BENT;
        m.student = (double)NAN; /* no range */
    }
    const double of_slope = filtration__error_of(&m, 0.0, 1.0), of_intercept = filtration__error_of(&m, 1.0, -mean);
    const double of_level = filtration__error_of(&m, 1.0, 0.0), most = of_slope * of_intercept;
    double covariance =
        (of_level * of_level - mean * mean * of_slope * of_slope - of_intercept * of_intercept) / (2.0 * mean);
    covariance = covariance > most ? most : covariance < -most ? -most : covariance;
    c->slope = filtration__estimate(slope * y_over_x, of_slope * y_over_x, c->student);
    c->intercept = filtration__estimate((level - slope * mean) * r->y_scale, of_intercept * r->y_scale, c->student);
    c->covariance = covariance * r->y_scale * y_over_x;
}

static inline void filtration__resistances(const filtration_curve_def *d, filtration_curve *c) {
    const double p = d->pressure_error, v = d->viscosity_error, a = d->area_error, k = d->cake_ratio_error;
    const double of_duty = p * p + v * v;
    c->product = filtration__times(c->slope, filtration_product_of_slope(1.0, d->pressure, d->viscosity, d->area),
                                   sqrt(of_duty + 4.0 * a * a), d->confidence, c->freedom);
    c->cake = filtration__times(c->slope,
                                filtration_product_of_slope(1.0, d->pressure, d->viscosity, d->area) / d->cake_ratio,
                                sqrt(of_duty + 4.0 * a * a + k * k), d->confidence, c->freedom);
    c->by_mass =
        filtration__times(c->slope, filtration_product_of_slope(1.0, d->pressure, d->viscosity, d->area) / d->solids,
                          sqrt(of_duty + 4.0 * a * a + d->solids_error * d->solids_error), d->confidence, c->freedom);
    c->medium = filtration__times(c->intercept, filtration_medium_of_intercept(1.0, d->pressure, d->viscosity, d->area),
                                  sqrt(of_duty + a * a), d->confidence, c->freedom);
    c->pressure = d->pressure, c->viscosity = d->viscosity, c->area = d->area, c->confidence = d->confidence;
}

FILTRATION_API filtration_status filtration_evaluate(const filtration_curve_def *def, size_t n, const double *time,
                                                     const double *volume, filtration_curve *result) {
    size_t first = 0, last = 0, count = 0;
    filtration__line line;
    if (!result) return FILTRATION_BAD_ARGUMENT;
    filtration__clear_curve(result);
    if (filtration_curve_check_def(def, NULL) != FILTRATION_OK) return FILTRATION_BAD_DEF;
    if (n > 0 && (!time || !volume)) return FILTRATION_BAD_ARGUMENT;
    filtration__readings r;
    r.def = def, r.time = time, r.volume = volume;
    filtration_status status = filtration__take(&r, n, 3, &first, &last, &count);
    if (status != FILTRATION_OK) return status;
    if (def->automatic && count > def->least_readings) filtration__longest_straight(&r, &first, &last);
    filtration__plain_line(&r, first, last, &line);
    if (!(line.sxx > 0.0 && filtration__is_finite(line.slope))) return FILTRATION_NO_SOLUTION;
    const filtration__bend bend = filtration__find_bend(&r, first, last, &line);
    result->first = first, result->last = last;
    result->smallest = volume[first], result->largest = volume[last];
    filtration__intervals(&r, first, last, &line, &bend, result);
    filtration__resistances(def, result);
    if (!(result->slope.low > 0.0) && !(result->remarks & FILTRATION_REMARK_BENT && result->slope.value > 0.0))
        result->remarks |= FILTRATION_REMARK_SLOPE;
    if (result->intercept.value < 0.0) result->remarks |= FILTRATION_REMARK_MEDIUM;
    const double all = result->remarks & FILTRATION_REMARK_BENT ? 0.0 : result->product.error + result->medium.error;
    if (filtration__is_finite(all) && filtration__is_finite(result->product.value) &&
        filtration__is_finite(result->medium.value))
        return FILTRATION_OK;
    filtration__clear_curve(result);
    return FILTRATION_NO_SOLUTION;
}

FILTRATION_API filtration_status filtration_evaluate_clean(const filtration_curve_def *def, size_t n,
                                                           const double *time, const double *volume, double last_volume,
                                                           filtration_estimate *medium) {
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
    filtration_status status = filtration__take(&r, n, 2, &first, &last, &count);
    if (status != FILTRATION_OK) return status;
    filtration__plain_line(&r, first, last, &line);
    line.slope = 0.0;
    filtration__mixture m;
    filtration__mix(&r, first, last, &line, 1, &m);
    const double level = line.mean_y + m.level, error = filtration__error_of(&m, 1.0, 0.0);
    const double freedom = m.freedom, a = def->area_error, p = def->pressure_error, v = def->viscosity_error;
    if (!(filtration__is_finite(error) && level > 0.0)) return FILTRATION_NO_SOLUTION;
    const filtration_estimate mean = filtration__estimate(level * r.y_scale, error * r.y_scale, 1.0);
    const filtration_estimate found =
        filtration__times(mean, filtration_medium_of_intercept(1.0, def->pressure, def->viscosity, def->area),
                          sqrt(p * p + v * v + a * a), def->confidence, freedom);
    if (!(filtration__is_finite(found.value) && filtration__is_finite(found.error))) return FILTRATION_NO_SOLUTION;
    *medium = found;
    return FILTRATION_OK;
}

FILTRATION_API filtration_status filtration_predict(const filtration_curve *curve, double pressure, double area,
                                                    double compressibility, double V, filtration_estimate *time) {
    if (!time) return FILTRATION_BAD_ARGUMENT;
    *time = filtration__estimate((double)NAN, (double)NAN, (double)NAN);
    if (!curve || !filtration__is_positive(pressure) || !filtration__is_positive(area) || !filtration__is_error(V) ||
        !(compressibility >= 0.0 && compressibility < 1.0) || !filtration__is_positive(curve->pressure))
        return FILTRATION_BAD_ARGUMENT;
    const double p = curve->pressure / pressure, a = curve->area / area;
    const double square = V * V * a * a * p * riddle_pow(pressure / curve->pressure, compressibility),
                 linear = V * a * p;
    const double variance = square * square * curve->slope.error * curve->slope.error +
                            linear * linear * curve->intercept.error * curve->intercept.error +
                            2.0 * square * linear * curve->covariance;
    *time = filtration__estimate(square * curve->slope.value + linear * curve->intercept.value,
                                 sqrt(variance > 0.0 ? variance : 0.0),
                                 filtration_student(curve->confidence, curve->freedom));
    if (curve->remarks & FILTRATION_REMARK_BENT)
        time->error = time->low = time->high = (double)NAN; /* no range, as of the line */
    else if (!filtration__is_finite(time->error)) time->value = (double)NAN;
    return filtration__is_finite(time->value) ? FILTRATION_OK : FILTRATION_NO_SOLUTION;
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
#define FILTRATION__OUTSIDE_TEXT(name, bit, text)                                                                      \
    if (flag == bit) return text;
    FILTRATION_OUTSIDES(FILTRATION__OUTSIDE_TEXT)
    return "unknown flag";
}
