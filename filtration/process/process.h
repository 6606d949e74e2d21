/* Size distributions, operations at constant rate and pressure, the evaluation of filter curves. */
#pragma once
#include "process_laws.h"

#define FILTRATION__ROUNDING 1e-12 /* share of t / V below which bend and scatter stem from rounded numbers, not from
                                      the filter */
#define FILTRATION__FEW 20.0 /* readings that do not tell whether neighbours are alike */

/* ---- size distributions ---- */

FILTRATION_API filtration_status filtration_convert_shares(size_t n, const double *d, const double *shares,
                                                           double power, double *out) {
    double largest = 0.0, sum = 0.0;
    if (!d || !shares || !out || n == 0 || !filtration__is_finite(power)) return FILTRATION_BAD_ARGUMENT;
    for (size_t i = 0; i < n; i++) {
        if (!(d[i] > 0.0 && filtration__is_finite(d[i]) && shares[i] >= 0.0 && filtration__is_finite(shares[i])))
            return FILTRATION_BAD_ARGUMENT;
        if (d[i] > largest) largest = d[i];
    }
    for (size_t i = 0; i < n; i++) sum += shares[i] > 0.0 ? shares[i] * riddle_pow(d[i] / largest, power) : 0.0;
    if (!(sum > 0.0 && filtration__is_finite(sum))) return FILTRATION_BAD_ARGUMENT;
    for (size_t i = 0; i < n; i++) out[i] = shares[i] > 0.0 ? shares[i] * riddle_pow(d[i] / largest, power) / sum : 0.0;
    return FILTRATION_OK;
}

FILTRATION_API filtration_status filtration_number_distribution(size_t n, const double *x, const double *Q3,
                                                                double *out) {
    if (!x || !Q3 || !out || n < 2 || Q3[0] != 0.0 || !(x[0] > 0.0)) return FILTRATION_BAD_ARGUMENT;
    double sum = 0.0;
    for (size_t i = 1; i < n; i++) {
        if (!(x[i] > x[i - 1] && filtration__is_finite(x[i]) && Q3[i] >= Q3[i - 1] && filtration__is_finite(Q3[i])))
            return FILTRATION_BAD_ARGUMENT;
    }
    /* mean of x^-3 over a class of constant density, over x[0]^-3 */
    double before = Q3[0];
    for (size_t i = 1; i < n; i++) {
        const double a = x[0] / x[i - 1], b = x[0] / x[i], step = Q3[i] - before;
        before = Q3[i];
        sum += step * 0.5 * a * b * (a + b);
        out[i] = sum;
    }
    out[0] = 0.0;
    if (!(sum > 0.0)) return FILTRATION_BAD_ARGUMENT;
    for (size_t i = 1; i < n; i++) out[i] /= sum;
    return FILTRATION_OK;
}

FILTRATION_API double filtration_sauter(size_t n, const double *d, const double *volume_shares) {
    double sum = 0.0, inverse = 0.0;
    if (!d || !volume_shares) return (double)NAN;
    for (size_t i = 0; i < n; i++) {
        if (!(d[i] > 0.0 && volume_shares[i] >= 0.0)) return (double)NAN;
        sum += volume_shares[i];
        inverse += volume_shares[i] / d[i];
    }
    return sum > 0.0 && filtration__is_finite(inverse) ? sum / inverse : (double)NAN;
}

/* ---- operations. w: volume of filtrate over area [m] ---- */

FILTRATION_API filtration_operation filtration_operation_default(void) {
    filtration_operation o;
    o.viscosity = 1e-3;
    o.area = 1.0;
    o.medium = 0.0;
    o.product = 0.0;
    o.compressibility = 0.0;
    o.reference = 1e5;
    o.pressure = 1e5;
    o.rate = HUGE_VAL;
    return o;
}

FILTRATION_API filtration_status filtration_operation_check(const filtration_operation *o, const char **field) {
    const char *bad = NULL;
    if (!o) bad = "operation";
    else if (!(o->viscosity > 0.0 && filtration__is_finite(o->viscosity))) bad = "viscosity";
    else if (!(o->area > 0.0 && filtration__is_finite(o->area))) bad = "area";
    else if (!(o->medium >= 0.0 && filtration__is_finite(o->medium))) bad = "medium";
    else if (!(o->product >= 0.0 && filtration__is_finite(o->product) && o->product + o->medium > 0.0)) bad = "product";
    else if (!(o->compressibility >= 0.0 && o->compressibility < 1.0)) bad = "compressibility";
    else if (!(o->reference > 0.0 && filtration__is_finite(o->reference))) bad = "reference";
    else if (!(o->pressure > 0.0)) bad = "pressure";
    else if (!(o->rate > 0.0) || (!filtration__is_finite(o->rate) && !filtration__is_finite(o->pressure))) bad = "rate";
    if (field) *field = bad;
    return bad ? FILTRATION_BAD_ARGUMENT : FILTRATION_OK;
}

/* Returns the fraction q of the pressure difference dp that lies in the cake: q^(1-n) = k (1 - q), k: resistance of the
   cake at dp over the medium's. Solved by Newton's method from the left of the root of a concave function. */
static inline double filtration__cake_share(const filtration_operation *o, double w) {
    const double n = o->compressibility;
    if (o->medium == 0.0) return 1.0;
    const double k = o->product * w * riddle_pow(o->pressure / o->reference, n) / o->medium;
    if (!(k > 0.0)) return 0.0;
    if (!(k <= FILTRATION__LARGEST)) return 1.0;
    if (n == 0.0) return k / (1.0 + k);
    double q = riddle_pow(k / (1.0 + k), 1.0 / (1.0 - n));
    for (int i = 0; i < 100 && q > 0.0; i++) {
        const double power = riddle_pow(q, 1.0 - n);
        const double next = q - (power - k * (1.0 - q)) / ((1.0 - n) * power / q + k);
        if (!(next > q * (1.0 + 1e-16))) break;
        q = next;
    }
    return q;
}

/* Returns the resistance of cake and medium at the constant pressure [1/m]. */
static inline double filtration__total_resistance(const filtration_operation *o, double w) {
    if (!(o->product > 0.0 && w > 0.0)) return o->medium;
    if (o->compressibility == 0.0) return o->product * w + o->medium;
    const double in_cake = filtration__cake_share(o, w) * o->pressure;
    return o->product * riddle_pow(in_cake / o->reference, o->compressibility) * w + o->medium;
}

/* Returns the integral of the resistance over w: in closed form for an incompressible cake, otherwise with 8 Gauss
   points in panels that halve towards the start, where the cake takes up the pressure. */
static inline double filtration__resistance_integral(const filtration_operation *o, double from, double to) {
    static const double node[4] = {0.18343464249564980494, 0.52553240991632898582, 0.79666647741362673959,
                                   0.96028985649753623168};
    static const double weight[4] = {0.36268378337836198297, 0.31370664587788728734, 0.22238103445337447054,
                                     0.10122853629037625915};
    if (o->compressibility == 0.0) return (0.5 * o->product * (from + to) + o->medium) * (to - from);
    double sum = 0.0, high = to;
    for (int panel = 0; panel < 60 && high > from; panel++) {
        double low = 0.5 * high;
        if (low < from || panel == 59) low = from;
        const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
        for (int i = 0; i < 4; i++)
            sum += half * weight[i] *
                   (filtration__total_resistance(o, middle - half * node[i]) +
                    filtration__total_resistance(o, middle + half * node[i]));
        high = low;
    }
    return sum;
}

/* Returns the point at a volume in the stage of constant rate. */
static inline filtration_point filtration__rate_point(const filtration_operation *o, double volume) {
    filtration_point p;
    const double n = o->compressibility, stress = o->viscosity * (o->rate / o->area), w = volume / o->area;
    p.volume = volume;
    p.time = volume / o->rate;
    p.flow = o->rate;
    p.cake = o->reference * riddle_pow(stress * o->product * w / o->reference, 1.0 / (1.0 - n));
    if (!(o->product > 0.0 && w > 0.0)) p.cake = 0.0;
    p.pressure = p.cake + stress * o->medium;
    return p;
}

FILTRATION_API filtration_status filtration_change_over(const filtration_operation *o, filtration_point *point) {
    if (!point || filtration_operation_check(o, NULL) != FILTRATION_OK) return FILTRATION_BAD_ARGUMENT;
    const double stress = o->viscosity * (o->rate / o->area), n = o->compressibility;
    double volume = 0.0;
    if (filtration__is_finite(o->rate) && o->pressure > stress * o->medium) {
        const double cake = o->pressure - stress * o->medium;
        volume = HUGE_VAL;
        if (o->product > 0.0 && filtration__is_finite(cake))
            volume = o->area * o->reference * riddle_pow(cake / o->reference, 1.0 - n) / (stress * o->product);
    }
    point->volume = volume;
    point->time = volume > 0.0 ? volume / o->rate : 0.0;
    point->pressure = o->pressure;
    if (volume > 0.0) {
        point->flow = o->rate;
        point->cake = o->pressure - stress * o->medium;
        if (!filtration__is_finite(volume)) point->cake = o->product > 0.0 ? HUGE_VAL : 0.0;
        if (!filtration__is_finite(volume) && o->product == 0.0) point->pressure = stress * o->medium;
    } else {
        point->cake = o->medium > 0.0 ? 0.0 : o->pressure;
        point->flow = o->medium > 0.0 ? o->area * (o->pressure / (o->viscosity * o->medium)) : HUGE_VAL;
    }
    return FILTRATION_OK;
}

/* Returns the point at a volume in the stage of constant pressure, which begins at `start`. */
static inline filtration_point filtration__pressure_point(const filtration_operation *o, const filtration_point *start,
                                                          double volume) {
    filtration_point p;
    const double w = volume / o->area;
    p.volume = volume;
    p.time = start->time + o->viscosity / o->pressure * filtration__resistance_integral(o, start->volume / o->area, w);
    p.pressure = o->pressure;
    p.flow = o->area * (o->pressure / (o->viscosity * filtration__total_resistance(o, w)));
    p.cake = o->product > 0.0 ? o->pressure * filtration__cake_share(o, w) : 0.0;
    return p;
}

FILTRATION_API filtration_status filtration_at_volume(const filtration_operation *o, double volume,
                                                      filtration_point *point) {
    filtration_point start;
    if (!point || !(volume >= 0.0 && filtration__is_finite(volume)) ||
        filtration_change_over(o, &start) != FILTRATION_OK)
        return FILTRATION_BAD_ARGUMENT;
    if (volume <= start.volume && start.volume > 0.0) *point = filtration__rate_point(o, volume);
    else if (volume == 0.0) *point = start;
    else *point = filtration__pressure_point(o, &start, volume);
    return filtration__is_finite(point->time) && filtration__is_finite(point->pressure) ? FILTRATION_OK
                                                                                        : FILTRATION_NO_SOLUTION;
}

FILTRATION_API filtration_status filtration_at_time(const filtration_operation *o, double time,
                                                    filtration_point *point) {
    filtration_point start;
    if (!point || !(time >= 0.0 && filtration__is_finite(time)) || filtration_change_over(o, &start) != FILTRATION_OK)
        return FILTRATION_BAD_ARGUMENT;
    if (time <= start.time) return filtration_at_volume(o, start.time > 0.0 ? time * o->rate : 0.0, point);
    /* starts as if the cake were incompressible, with its resistance at the pressure: that volume is too small */
    const double factor = o->viscosity / (o->pressure * o->area);
    const double stiff = o->product * riddle_pow(o->pressure / o->reference, o->compressibility);
    const double slope = 0.5 * factor * stiff / o->area,
                 intercept = factor * (stiff * start.volume / o->area + o->medium);
    double volume = start.volume + filtration_volume_of_time(slope, intercept, time - start.time);
    *point = filtration__pressure_point(o, &start, volume);
    if (o->compressibility > 0.0 && filtration__is_finite(point->time)) {
        /* goes to the right of the root, then uses Newton's method: time is convex in volume */
        for (int i = 0; point->time < time; i++) {
            if (i == 100) return FILTRATION_NO_SOLUTION;
            volume = start.volume + 2.0 * (volume - start.volume);
            *point = filtration__pressure_point(o, &start, volume);
        }
        for (int i = 0; i < 60; i++) {
            const double next = volume - (point->time - time) * point->flow;
            if (!(next < volume * (1.0 - 1e-15))) break;
            volume = next;
            *point = filtration__pressure_point(o, &start, volume);
        }
    }
    point->time = time;
    return filtration__is_finite(volume) && volume > 0.0 && filtration__is_finite(point->flow) ? FILTRATION_OK
                                                                                               : FILTRATION_NO_SOLUTION;
}
