/* >>student-t: Student's t by the incomplete beta function. Identical in every Riddle header that needs it
   (base/student.h is the master, tests/check_headers compares the copies). */
/* clang-format off */
#ifndef RIDDLE_STUDENT
#define RIDDLE_STUDENT
/* Returns the logarithm of the beta function B(a, 1/2), a > 0, by the expansion of gamma(a + 1/2) / gamma(a) from 20
   on. */
static inline double riddle__log_beta_half(double a) {
    double ratio = 1.0;
    for (; a < 20.0; a += 1.0) ratio *= (a + 0.5) / a;
    const double z = 1.0 / (a * a);
    const double series = (1.0 / 8.0 - z * (1.0 / 192.0 - z * (1.0 / 640.0 - z * 17.0 / 14336.0))) / a;
    return 0.57236494292470008707 - 0.5 * riddle_log(a) + series + riddle_log(ratio);
}

/* Returns the continued fraction of the incomplete beta function (Lentz's method; Abramowitz and Stegun 26.5.8). */
static inline double riddle__beta_fraction(double a, double b, double x) {
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
static inline double riddle__student_tail(double freedom, double t, double *density) {
    const double a = 0.5 * freedom, b = 0.5, x = freedom / (freedom + t * t), rest = t * t / (freedom + t * t);
    const double log_x = -riddle_log1p(t * t / freedom), log_beta = riddle__log_beta_half(a);
    *density = 2.0 / sqrt(freedom) * riddle_exp((a + 0.5) * log_x - log_beta);
    if (!(rest > 0.0)) return 1.0;
    const double front = riddle_exp(a * log_x - log_beta) * sqrt(rest);
    if (x < (a + 1.0) / (a + b + 2.0)) return front * riddle__beta_fraction(a, b, x) / a;
    return 1.0 - front * riddle__beta_fraction(b, a, rest) / b;
}

/* Returns the half-width, in standard errors, of a range that holds the share `confidence` of Student's t. NaN outside
   of confidence in (0, 1), freedom > 0. Student 1908. */
static inline double riddle_student(double confidence, double freedom) {
    if (!(confidence > 0.0 && confidence < 1.0 && freedom > 0.0)) return (double)NAN;
    if (freedom > 1e8) freedom = 1e8; /* the normal distribution, to 1e-8 */
    double low = 0.0, high = 1.0, density;
    while (high < 1e150 && riddle__student_tail(freedom, high, &density) > 1.0 - confidence) low = high, high *= 2.0;
    double t = high;
    for (int i = 0; i < 200; i++) { /* Newton's method, kept within the bracket */
        const double excess = riddle__student_tail(freedom, t, &density) - (1.0 - confidence);
        if (excess > 0.0) low = t;
        else high = t;
        double next = t + excess / density;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (next == t || fabs(next - t) <= 1e-15 * t) break;
        t = next;
    }
    return t;
}
#endif /* RIDDLE_STUDENT */
/* clang-format on */
/* <<student-t */
