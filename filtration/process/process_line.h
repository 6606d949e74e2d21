/* A straight line through readings whose scatter is unknown: how it grows with the volume, and how similar neighbours
   are. */
#pragma once
#include "process.h"

/* An error is white noise with the variance `white`, plus a part that keeps a share of its value and gets a random step
   at each reading. */
typedef struct filtration__roughness {
    double keeps, step, white; /* step, white: variances */
    int for_bend;              /* 1: used to tell a bend from scatter (three kinds are enough) */
} filtration__roughness;

/* A drift of the balance in proportion to time: its effect at the end, over the scatter of a reading there. */
typedef struct filtration__drifting {
    double size, prior;
} filtration__drifting;

enum {
    FILTRATION__WEIGHTS = 4,
    FILTRATION__ROUGHS = 7,
    FILTRATION__DRIFTS = 2,
    FILTRATION__FITS = FILTRATION__WEIGHTS * FILTRATION__ROUGHS,
    FILTRATION__KINDS = FILTRATION__FITS * FILTRATION__DRIFTS
};
static const filtration__drifting filtration__drifts[FILTRATION__DRIFTS] = {{0.0, 0.4}, {7.0, 0.6}};
/* About equal chances where volumes lie evenly; see filtration__fill_priors. */
static const double filtration__weight_prior[FILTRATION__WEIGHTS] = {6.0, 2.7, 2.7, 1.0};
static const filtration__roughness filtration__roughs[FILTRATION__ROUGHS] = {
    /* independent errors */
    {0.0, 0.0, 1.0, 1},
    /* each similar to the one before, of variance 1 */
    {0.3, 0.91, 0.0, 0},
    {0.6, 0.64, 0.0, 1},
    {0.8, 0.36, 0.0, 0},
    /* errors that add up, as those of a wandering balance */
    {1.0, 0.03, 1.0, 0},
    {1.0, 0.3, 1.0, 1},
    {1.0, 1.0, 0.0, 0}};

/* The readings, and the scales that keep sums in the range of doubles. */
typedef struct filtration__readings {
    const filtration_curve_def *def;
    const double *time, *volume;
    double x_scale, y_scale;
} filtration__readings;

/* Computes the abscissa V + V1, the ordinate (t - t1) / (V - V1) and the volume u = V - V1 of reading i, scaled.
   Returns 0 if it is left out. */
static inline int filtration__reading(const filtration__readings *r, size_t i, double *x, double *y, double *u) {
    const filtration_curve_def *d = r->def;
    const double t = r->time[i] - d->start_time, V = r->volume[i] - d->start_volume;
    if (!(t > 0.0 && V > 0.0 && r->volume[i] >= d->first_volume && r->volume[i] <= d->last_volume)) return 0;
    *x = (r->volume[i] + d->start_volume) / r->x_scale;
    *y = t / V / r->y_scale;
    *u = V / r->x_scale;
    return 1;
}

/* A line y = mean_y + slope (x - mean_x) by least squares of t, which small volumes cannot upset. The kinds of scatter
   correct it. */
typedef struct filtration__line {
    size_t n;
    double mean_x, mean_y, sxx, slope, low, high, end; /* low, high: range of x; end: largest u */
} filtration__line;

static inline void filtration__plain_line(const filtration__readings *r, size_t first, size_t last,
                                          filtration__line *line) {
    double x, y, u, weights = 0.0, sxy = 0.0;
    memset(line, 0, sizeof *line);
    line->low = HUGE_VAL, line->high = -HUGE_VAL;
    for (size_t i = first; i <= last; i++) {
        if (!filtration__reading(r, i, &x, &y, &u)) continue;
        line->n++;
        weights += u * u, line->mean_x += u * u * x, line->mean_y += u * u * y;
        if (x < line->low) line->low = x;
        if (x > line->high) line->high = x;
        if (u > line->end) line->end = u;
    }
    line->mean_x /= weights, line->mean_y /= weights;
    for (size_t i = first; i <= last; i++) {
        if (!filtration__reading(r, i, &x, &y, &u)) continue;
        line->sxx += u * u * (x - line->mean_x) * (x - line->mean_x),
            sxy += u * u * (x - line->mean_x) * (y - line->mean_y);
    }
    line->slope = line->sxx > 0.0 ? sxy / line->sxx : 0.0;
}

/* Returns the ordinate of the line at a volume, and in rate dt / dV there; a line that reaches 0 is cut off. */
static inline double filtration__on_line(const filtration__line *line, double x, double u, double *rate) {
    const double rise = line->slope > 0.0 ? line->slope : 0.0, least = 0.05 * line->mean_y;
    double y = line->mean_y + rise * (x - line->mean_x);
    if (!(y > least)) y = least;
    *rate = y + rise * u;
    return y;
}

/* Returns the factor that gives a reading's ordinate the scatter of the others: V over the error of t, where that is
   constant (weight 0), that of a constant error of V (1), in proportion to V (2), or to t (3). */
static inline double filtration__factor(const filtration__readings *r, const filtration__line *line, int weight,
                                        double x, double u) {
    const filtration_curve_def *d = r->def;
    double rate;
    const double y = filtration__on_line(line, x, u, &rate);
    if (d->time_error > 0.0 || d->volume_error > 0.0) {
        const double in_time = d->time_error / r->y_scale / r->x_scale, in_volume = d->volume_error / r->x_scale * rate;
        return u / sqrt(in_time * in_time + in_volume * in_volume);
    }
    return weight == 0 ? u : weight == 1 ? u / rate : weight == 2 ? 1.0 : 1.0 / y;
}

/* The readings seen through one kind of scatter. */
typedef struct filtration__kind {
    double level, slope;                  /* corrections of the plain line at mean_x */
    double of_level, of_both, of_slope;   /* inverse of the normal matrix */
    double squares, likelihood;           /* residual sum of squares; logarithm of the likelihood, up to a constant */
    double drifted[2];                    /* change of level and slope by a drift of the balance by `end` at the
                                             last reading */
    double drift;                         /* that drift, if there is one: shares of end */
    double bent_squares, bent_likelihood; /* with a parabola and a cubic in addition */
    double coefficient[2];                /* of them, over half the range */
} filtration__kind;

/* Turns the first `pivots` columns of the normal matrix g [n][n] (lower half) into Cholesky's factor, the rest into
   what remains of it. Returns the logarithm of the factor's determinant. */
static inline double filtration__decompose(double *g, int n, int pivots) {
    double determinant = 0.0;
    for (int k = 0; k < pivots; k++) {
        double *const pivot = &g[n * k];
        const double root = pivot[k] > 0.0 ? sqrt(pivot[k]) : 0.0;
        if (root > 0.0) determinant += riddle_log(root);
        for (int i = k; i < n; i++) g[n * i + k] = root > 0.0 ? g[n * i + k] / root : 0.0;
        for (int i = k + 1; i < n; i++)
            for (int j = k + 1; j <= i; j++) g[n * i + j] -= g[n * i + k] * g[n * j + k];
    }
    return determinant;
}

/* Sums the normal matrix of level, slope, parabola, cubic, drift and the plain line's residual, each made independent
   by the prediction from the readings before (Kalman 1960). Returns the logarithm of the factor between densities. */
enum { FILTRATION__COLUMNS = 6 };
static inline double filtration__normal_matrix(const filtration__readings *r, size_t first, size_t last,
                                               const filtration__line *line, int weight,
                                               const filtration__roughness *rough,
                                               double g[FILTRATION__COLUMNS][FILTRATION__COLUMNS]) {
    const double half = 0.5 * (line->high - line->low), middle = 0.5 * (line->high + line->low), keeps = rough->keeps;
    double before[FILTRATION__COLUMNS], row[FILTRATION__COLUMNS], x, y, u, rate, logs = 0.0, product = 1.0;
    double variance = keeps < 1.0 ? rough->step / (1.0 - keeps * keeps) : rough->step;
    const double y_end = filtration__on_line(line, line->high, line->end, &rate);
    const double end = filtration__factor(r, line, weight, line->high, line->end);
    memset(g, 0, sizeof(double) * FILTRATION__COLUMNS * FILTRATION__COLUMNS);
    memset(before, 0, sizeof before);
    for (size_t i = first; i <= last; i++) {
        if (!filtration__reading(r, i, &x, &y, &u)) continue;
        const double factor = filtration__factor(r, line, weight, x, u) / end,
                     z = half > 0.0 ? (x - middle) / half : 0.0;
        const double on_line = filtration__on_line(line, x, u, &rate), sum = variance + rough->white,
                     share = 1.0 / sqrt(sum);
        const double now[FILTRATION__COLUMNS] = {factor,
                                                 factor * (x - line->mean_x),
                                                 factor * (z * z - 1.0 / 3.0),
                                                 factor * (z * z - 0.6) * z,
                                                 factor * rate * on_line / y_end,
                                                 factor * (y - line->mean_y - line->slope * (x - line->mean_x))};
        product *= factor * share;
        if (!(product > 1e-200 && product < 1e200)) logs += riddle_log(product), product = 1.0;
        for (int k = 0; k < FILTRATION__COLUMNS; k++) {
            row[k] = now[k] - before[k];
            before[k] = keeps * (before[k] + variance / sum * row[k]);
            row[k] *= share;
        }
        variance = keeps * keeps * variance * (1.0 - variance / sum) + rough->step;
        for (int k = 0; k < FILTRATION__COLUMNS; k++)
            for (int m = 0; m <= k; m++) g[k][m] += row[k] * row[m];
    }
    return logs + riddle_log(product);
}

/* Fits a level, or a level and a slope (unknowns 1, 2), by the normal matrix of a kind of scatter. drift: standard
   error of an ordinate at the line's end by a drift of the balance, over that of a reading there; 0: none. The drift is
   an unknown with the expectation 0, which enters as an observation. */
static inline void filtration__fit_line(double g[FILTRATION__COLUMNS][FILTRATION__COLUMNS], double drift, double rate,
                                        double logs, double least, int unknowns, const filtration__line *line,
                                        filtration__kind *kind) {
    const int of_line[4] = {0, 1, 4, 5}, of_drift[4] = {4, 0, 1, 5}, *columns = drift > 0.0 ? of_drift : of_line;
    const int first = drift > 0.0 ? 1 : 0, pivots = 2 + first;
    const double n = (double)line->n, expected = drift > 0.0 ? rate / drift : 0.0;
    double f[4][4];
    for (int i = 0; i < 4; i++)
        for (int j = 0; j <= i; j++) {
            const int high = columns[i] > columns[j] ? columns[i] : columns[j], low = columns[i] + columns[j] - high;
            f[i][j] = g[high][low];
        }
    if (drift > 0.0) f[0][0] += expected * expected;
    if (unknowns == 1)
        for (int i = first + 1; i < 4; i++) f[i][first + 1] = 0.0;
    const double determinant = filtration__decompose(f[0], 4, pivots);
    const double a = f[first][first], b = f[first + 1][first], c = f[first + 1][first + 1];
    const double *rest = f[3], *of = drift > 0.0 ? NULL : f[2];
    memset(kind, 0, sizeof *kind);
    kind->squares = rest[3] > least ? rest[3] : least;
    if (unknowns == 2) {
        kind->slope = rest[first + 1] / c, kind->drifted[1] = of ? of[1] / c : 0.0;
        kind->of_slope = 1.0 / (c * c), kind->of_both = -b / (a * c * c);
    }
    kind->level = (rest[first] - b * kind->slope) / a;
    kind->drifted[0] = of ? (of[0] - b * kind->drifted[1]) / a : 0.0;
    kind->of_level = 1.0 / (a * a) - b / a * kind->of_both;
    kind->drift = of && of[2] > 0.0 ? rest[2] / of[2] : 0.0;
    kind->likelihood = logs - determinant - 0.5 * (n - unknowns) * riddle_log(kind->squares);
    if (drift > 0.0) kind->likelihood += riddle_log(expected);
}

/* The same fit with a parabola and a cubic in addition. */
static inline void filtration__fit_bend(double g[FILTRATION__COLUMNS][FILTRATION__COLUMNS], double logs, double least,
                                        const filtration__line *line, filtration__kind *kind) {
    const int columns[5] = {0, 1, 2, 3, 5};
    double bent[5][5];
    for (int i = 0; i < 5; i++)
        for (int j = 0; j <= i; j++) bent[i][j] = g[columns[i]][columns[j]];
    const double of_bent = filtration__decompose(bent[0], 5, 4);
    kind->bent_squares = bent[4][4] > least ? bent[4][4] : least;
    kind->bent_likelihood = logs - of_bent - 0.5 * ((double)line->n - 4.0) * riddle_log(kind->bent_squares);
    kind->coefficient[1] = bent[3][3] > 0.0 ? bent[4][3] / bent[3][3] : 0.0;
    kind->coefficient[0] = bent[2][2] > 0.0 ? (bent[4][2] - bent[3][2] * kind->coefficient[1]) / bent[2][2] : 0.0;
}

/* Fits one kind of scatter, without a drift of the balance and with drifts that were not stated: fills drifts
   entries. */
static inline void filtration__fit_kind(const filtration__readings *r, size_t first, size_t last,
                                        const filtration__line *line, int unknowns, int weight,
                                        const filtration__roughness *rough, int drifts, filtration__kind *kind) {
    double g[FILTRATION__COLUMNS][FILTRATION__COLUMNS], rate;
    const double logs = filtration__normal_matrix(r, first, last, line, weight, rough, g);
    const double rounding = FILTRATION__ROUNDING * 1e-2 * line->mean_y, least = g[0][0] * rounding * rounding;
    filtration__on_line(line, line->high, line->end, &rate);
    for (int k = 0; k < drifts; k++)
        filtration__fit_line(g, filtration__drifts[k].size, rate, logs, least, unknowns, line, &kind[k]);
    filtration__fit_bend(g, logs, least, line, kind);
}

/* Returns whether a kind is considered: all are, or those that the definition leaves. */
static inline int filtration__is_thought_of(const filtration_curve_def *d, int kind) {
    const int weights = d->time_error > 0.0 || d->volume_error > 0.0 ? 1 : FILTRATION__WEIGHTS;
    return kind / FILTRATION__ROUGHS < weights && (!d->independent || kind % FILTRATION__ROUGHS == 0);
}

/* Returns how evenly a kind of scatter takes its knowledge from the readings: the number of readings that would tell as
   much if all told alike (Kish 1965), as a share of them. An error in proportion to t: 1. */
static inline double filtration__evenness(const filtration__readings *r, size_t first, size_t last,
                                          const filtration__line *line, int weight) {
    double x, y, u, rate, sum = 0.0, squares = 0.0;
    for (size_t i = first; i <= last; i++) {
        if (!filtration__reading(r, i, &x, &y, &u)) continue;
        const double root = filtration__factor(r, line, weight, x, u) * filtration__on_line(line, x, u, &rate);
        sum += root * root, squares += root * root * root * root;
    }
    const double share = sum * sum / (squares * (double)line->n);
    return share > 0.1 ? share : 0.1;
}

/* Fills the prior of each law of scatter. Where volumes span decades, a law by which the last two or three readings
   fix the line has a high likelihood whenever these lie on a line by chance, and its range is then far too narrow: the
   less even a law is, the less it is trusted. Returns the degrees of freedom that not knowing the law costs: none for
   even volumes, up to one. The constants were chosen so that ranges hold about alike for all laws and spacings
   (scripts/verify filter_ranges). */
static inline double filtration__fill_priors(const filtration__readings *r, size_t first, size_t last,
                                             const filtration__line *line, double prior[FILTRATION__WEIGHTS]) {
    double loss = 0.0;
    for (int weight = 0; weight < FILTRATION__WEIGHTS; weight++) {
        const double even = filtration__evenness(r, first, last, line, weight);
        prior[weight] = filtration__weight_prior[weight] * even * even;
        if (weight == 0 && even < 0.4) loss = 1.5 * (1.0 - even / 0.4);
    }
    return r->def->time_error > 0.0 || r->def->volume_error > 0.0 ? 0.0 : loss < 1.0 ? loss : 1.0;
}

/* The mean over the kinds. */
typedef struct filtration__mixture {
    int n;
    double share[FILTRATION__KINDS];
    filtration__kind kind[FILTRATION__KINDS];
    double level, slope, drifted[2], rough; /* means */
    double freedom, confidence, student;
    double drift; /* standard error of the balance at the last reading, in shares of the line's end */
} filtration__mixture;

/* Computes the means. The line is the one without an unstated drift, which only widens the range. */
static inline void filtration__average(filtration__mixture *m, int drifts) {
    double sum = 0.0, still = 0.0;
    for (int k = 0; k < m->n; k++) {
        sum += m->share[k];
        if (k % drifts == 0) still += m->share[k];
    }
    for (int k = 0; k < m->n; k++) {
        const filtration__kind *kind = &m->kind[k];
        const double share = k % drifts == 0 && still > 0.0 ? m->share[k] / still : 0.0;
        m->level += share * kind->level, m->slope += share * kind->slope;
        m->drifted[0] += share * kind->drifted[0], m->drifted[1] += share * kind->drifted[1];
        m->share[k] = m->share[k] > 3e-4 * sum ? m->share[k] / sum : 0.0;
        m->rough += m->share[k] * kind->likelihood;
    }
}

static inline void filtration__mix(const filtration__readings *r, size_t first, size_t last,
                                   const filtration__line *line, int unknowns, filtration__mixture *m) {
    double best = -HUGE_VAL, of_weight[FILTRATION__WEIGHTS];
    memset(m, 0, sizeof *m);
    const double loss = filtration__fill_priors(r, first, last, line, of_weight);
    m->freedom = (double)line->n - unknowns - (unknowns == 2 ? loss : 0.0), m->confidence = r->def->confidence;
    m->student = filtration_student(m->confidence, m->freedom);
    m->drift = r->def->drift_error / r->x_scale / line->end;
    const int drifts = unknowns == 1 || r->def->independent || m->drift > 0.0 ? 1 : FILTRATION__DRIFTS;
    for (int k = 0; k < FILTRATION__FITS; k++) {
        if (!filtration__is_thought_of(r->def, k)) continue;
        const filtration__roughness *rough = &filtration__roughs[k % FILTRATION__ROUGHS];
        filtration__fit_kind(r, first, last, line, unknowns, k / FILTRATION__ROUGHS, rough, drifts, &m->kind[m->n]);
        for (int q = 0; q < drifts; q++, m->n++) {
            filtration__kind *kind = &m->kind[m->n];
            const double prior = of_weight[k / FILTRATION__ROUGHS] * filtration__drifts[q].prior;
            m->share[m->n] = riddle_log(prior) + kind->likelihood;
            /* From here on: of neighbours. */
            kind->likelihood = rough->white > 0.0 && rough->step == 0.0 ? 0.0 : rough->keeps;
            if (m->share[m->n] > best) best = m->share[m->n];
        }
    }
    for (int k = 0; k < m->n; k++) m->share[k] = riddle_exp(m->share[k] - best);
    filtration__average(m, drifts);
}

/* Returns the standard error of level times the level and slope times the slope. With Student's factor it gives the
   half width of the interval about the mean that holds the confidence, including the drift's part. */
static inline double filtration__error_of(const filtration__mixture *m, double level, double slope) {
    const double centre = level * m->level + slope * m->slope;
    double mean[FILTRATION__KINDS], scale[FILTRATION__KINDS], low = 0.0, high = 0.0, half = 0.0;
    for (int k = 0; k < m->n; k++) {
        const filtration__kind *kind = &m->kind[k];
        const double variance =
            level * level * kind->of_level + 2.0 * level * slope * kind->of_both + slope * slope * kind->of_slope;
        mean[k] = level * kind->level + slope * kind->slope - centre;
        scale[k] = sqrt(kind->squares / m->freedom * (variance > 0.0 ? variance : 0.0));
        const double most = m->share[k] > 0.0 ? fabs(mean[k]) + m->student * scale[k] : 0.0;
        half += m->share[k] * most;
        if (most > high) high = most;
    }
    for (int i = 0; i < 60 && high > 0.0 && filtration__is_finite(high); i++) { /* Newton's method within a bracket */
        double outside = m->confidence - 1.0, density = 0.0;
        for (int k = 0; k < m->n; k++) {
            for (int side = -1; side <= 1 && m->share[k] > 0.0; side += 2) {
                const double t = (half + side * mean[k]) / scale[k];
                double at;
                const double tail = 0.5 * riddle__student_tail(m->freedom, fabs(t), &at);
                outside += m->share[k] * (t >= 0.0 ? tail : 1.0 - tail), density += 0.5 * m->share[k] * at / scale[k];
            }
        }
        if (outside > 0.0) low = half;
        else high = half;
        const double next = half + outside / density, step = fabs(next - half);
        half = next > low && next < high ? next : 0.5 * (low + high);
        if (step <= 1e-6 * half || !(high - low > 1e-12 * high)) break; /* each step doubles the digits */
    }
    const double of_drift =
        m->drift * (level * m->drifted[0] + slope * m->drifted[1]) * filtration_student(m->confidence, 1e9);
    return sqrt(half * half + of_drift * of_drift) / m->student;
}
