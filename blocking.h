/* blocking.h: how the holes of a sieve block and free themselves, what that costs, and how to find the two rate
   constants.

   #include "blocking.h"
   #include <stdio.h>

   int main(void) {
       // free holes / holes, counted on the stopped sieve
       const double t[] = {0, 5, 10, 30}, f[] = {0.949, 0.937, 0.926, 0.888};
       blocking_fit_def    def = blocking_default_fit_def();
       blocking_fit_result fit;
       blocking_status     s = blocking_fit(&def, t, f, NULL, 4, &fit);
       printf("%s: f_inf %.3f, k1 %.4f, k2 %.4f 1/s\n", blocking_status_text(s), fit.f_inf, fit.k1, fit.k2);
       // 0.55 .. 0.82: four readings say little
       printf("95 %% range of f_inf %.2f .. %.2f\n", fit.f_inf_lowest, fit.f_inf_highest);
       printf("mean of 60 s %.3f\n", blocking_time_mean(fit.f0, fit.f_inf, fit.k, 60.0));
   }

   Source: Lawinska, Modrzewski & Wodzinski, Granular Matter 18 (2016) 13, "the paper"; equation and table numbers are
   its own. docs/blocking.md has the equations, the errata, and which of them were checked how.

   f is the FREE fraction of the holes (eq 4): 1 is a clean sieve, 0 a blocked one. The paper calls it "blocking
   coefficient".

   Models   relative size, hard-to-screen content and toss indicator (eqs 1-3, Table 1); blocking and unblocking of
            first order, pure and together (eqs 5-13), with constant or changing rate constants; three-point estimator
            (eqs 14, 15, for any times); least squares; mean free fraction as a polynomial of K and x_h (Table 3, as
            printed and repaired); polynomials of n variables (eq 16); effective area, clearance and deck area (eqs 17,
            18).
   Units    SI: t [s], k k1 k2 [1/s], n [Hz], A [m], angles [rad], areas [m2]. f, x_h and all shares are fractions 0..1,
            never percent.
   Errors   laws return NaN outside the domain their comment states; drivers return a blocking_status and leave NaN what
            they cannot tell.
   Memory   nothing is allocated; arrays are the caller's and are read or filled during the call only.
   Threads  no state anywhere: every function may run in any thread.
   Bits     only + - * / sqrt and the portable block below: the same on every machine that does not fuse products
            (-ffp-contract=off).
   Linking  every function is static inline. For one shared copy: #define BLOCKING_API extern before every inclusion,
            and BLOCKING_IMPLEMENTATION as well in one file. The laws stay inline.
   Not here: k1 and k2 from K and x_h. The paper has no law for them; they come from counted holes (blocking_fit) or
   a simulation. */
#ifndef BLOCKING_H
#define BLOCKING_H

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "blocking.h needs NaN and infinity: compile without -ffast-math"
#endif

#include <math.h>
#include <stddef.h>

#ifndef BLOCKING_API
#define BLOCKING_API static inline
#define BLOCKING__BODIES
#elif defined(BLOCKING_IMPLEMENTATION)
#define BLOCKING__BODIES
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ===================================================== status ===================================================== */

#define BLOCKING_STATUSES(X)                                                                                           \
    X(BLOCKING_OK, "ok")                                                                                               \
    X(BLOCKING_NO_CHANGE, "the readings do not change: f_inf is their value, k is not determined")                     \
    X(BLOCKING_NON_MONOTONE, "the readings turn back or stop at once: no exponential passes through them")             \
    X(BLOCKING_NOT_SATURATING, "the readings do not level off (straight or accelerating): f_inf is not determined")    \
    X(BLOCKING_NOT_RESOLVED, "all change lies between two readings: k is only known from below")                       \
    X(BLOCKING_OUT_OF_RANGE, "f_inf or f0 comes out below 0 or above 1")                                               \
    X(BLOCKING_TOO_FEW, "too few values")                                                                              \
    X(BLOCKING_NOT_FINITE, "a value is NaN or infinite")                                                               \
    X(BLOCKING_NOT_RISING, "times or sizes must rise from each value to the next, times from 0 on")                    \
    X(BLOCKING_IN_PERCENT, "a fraction is above 1: give it as 0..1, not in percent")                                   \
    X(BLOCKING_NEGATIVE, "a value that must not be negative is")                                                       \
    X(BLOCKING_NOT_CUMULATIVE, "the share that passes falls from one size to the next")                                \
    X(BLOCKING_NOT_COVERED, "the size curve is not known between 0.8 and 1.2 openings")                                \
    X(BLOCKING_BAD_COUNT, "more free holes than holes, or no holes at all")                                            \
    X(BLOCKING_BAD_ARGUMENT, "an argument is NULL or out of its range")                                                \
    X(BLOCKING_BAD_DEF, "a field of the definition is out of its range; the check function names it")                  \
    X(BLOCKING_BAD_RATE, "k1 or k2 came back negative or not finite")                                                  \
    X(BLOCKING_TOO_MANY_STEPS, "the tolerance was not reached within max_steps")                                       \
    X(BLOCKING_UNDETERMINED, "the points do not determine every coefficient")

#define BLOCKING__ENUM(name, text) name,
typedef enum blocking_status { BLOCKING_STATUSES(BLOCKING__ENUM) BLOCKING_STATUS_COUNT } blocking_status;
#undef BLOCKING__ENUM

/* Returns one sentence without a full stop; "unknown status" for a number that is none. The text is a constant. */
BLOCKING_API const char *blocking_status_text(blocking_status status);

/* ===================================================== grains ===================================================== */

/* Returns the relative grain size phi = d / l (eq 1) [-]. d: mean grain diameter [m] >= 0, l: size of the
   hole [m] > 0. */
static inline double blocking_relative_size(double d, double l);

/* Returns 1 if 0.8 <= phi <= 1.2 (eq 2, both ends belong to it, to 1e-15), else 0; 0 for NaN. */
static inline int blocking_is_hard_to_screen(double phi);

/* Share of the mass that is hard to screen (eq 2), split as in section 1.1 of the paper. x_h = below + above. */
typedef struct blocking_hard {
    double x_h;   /* [-] 0..1 */
    double below; /* 0.8 l <= d <= l: they pass, but slowly ("undersized") [-] */
    double above; /* l < d <= 1.2 l: they never pass and may stick ("blocking") [-] */
} blocking_hard;

/* Computes the shares from classes: diameter[n] [m] > 0 in any order, mass[n] >= 0 in any unit (not all zero), opening
   l [m] > 0. A class counts with its whole mass. NEGATIVE, TOO_FEW (n 0 or no mass), NOT_FINITE, BAD_ARGUMENT. */
BLOCKING_API blocking_status blocking_hard_from_classes(const double *diameter, const double *mass, size_t n,
                                                        double opening, blocking_hard *out);

/* Computes the shares from a cumulative curve: passing[n] = mass fraction finer than size[n] [m], sizes rising,
   straight lines between the points. Before the first point the curve is known only if passing[0] is 0, after the last
   only if passing[n-1] is 1: else NOT_COVERED. IN_PERCENT, NEGATIVE, NOT_CUMULATIVE, NOT_RISING, TOO_FEW (n < 2),
   NOT_FINITE, BAD_ARGUMENT. */
BLOCKING_API blocking_status blocking_hard_from_curve(const double *size, const double *passing, size_t n,
                                                      double opening, blocking_hard *out);

/* =================================================== vibration ==================================================== */

/* Returns the toss indicator K = (2 pi n)^2 A sin(beta) / (g cos(alpha)) (eq 3) [-]: largest acceleration of the deck
   over gravity, both along its normal. n: frequency [Hz] (rpm / 60) >= 0; A: amplitude, half the stroke [m] >= 0; beta:
   direction of the vibration against the deck [rad] 0..pi; alpha: slope of the deck [rad], cos(alpha) > 0;
   g [m/s2] > 0. NaN outside. */
static inline double blocking_toss_indicator(double n, double A, double beta, double alpha, double g);

/* Returns the normal amplitude A sin(beta) [m] that gives the toss indicator K >= 0 at frequency n > 0
   (eq 3 solved). */
static inline double blocking_toss_amplitude(double K, double n, double alpha, double g);

/* Returns the frequency [Hz] that gives the toss indicator K >= 0 with amplitude A > 0 (eq 3 solved). sin(beta) > 0. */
static inline double blocking_toss_frequency(double K, double A, double beta, double alpha, double g);

#define BLOCKING_TOSSES(X)                                                                                             \
    X(BLOCKING_TOSS_UNDEFINED, "no toss indicator: negative or not a number")                                          \
    X(BLOCKING_TOSS_NONE, "K < 1: grains never leave the deck")                                                        \
    X(BLOCKING_TOSS_UNLISTED, "Table 1 has no guideline for this K")                                                   \
    X(BLOCKING_TOSS_EASY, "K 2.0-3.3: easy-to-screen grains without a tendency to clog")                               \
    X(BLOCKING_TOSS_AVERAGE, "K 4.5-6.5: average grains, slightly moist, minor tendency to block")                     \
    X(BLOCKING_TOSS_HARD, "K 7-10: very hard-to-screen grains, moist, sticky, easily clogging")
#define BLOCKING__ENUM(name, text) name,
typedef enum blocking_toss { BLOCKING_TOSSES(BLOCKING__ENUM) BLOCKING_TOSS_COUNT } blocking_toss;
#undef BLOCKING__ENUM

/* Returns the row of Table 1 for a toss indicator (ends belong to it, to 1e-15), and its text. */
static inline blocking_toss blocking_toss_range(double K);
BLOCKING_API const char *blocking_toss_text(blocking_toss range);

/* ================================================= counted holes ================================================== */

/* Returns 1 if the bed is too thick for this description, H / D_z >= 0.1 (section 3.1; to 1e-15), else 0. H: height of
   the bed [m] >= 0,
   D_z: diameter of the sieve [m] > 0. Also 1 for values outside that. */
static inline int blocking_bed_too_thick(double H, double D_z);

typedef struct blocking_count {
    double free_fraction;  /* f = free / all holes (eq 4), all spots together [-] */
    double blocked;        /* 1 - f [-] */
    double standard_error; /* of f, holes independent: sqrt(f (1 - f) / holes) [-]; 0 for f 0 or 1. Fit counts by
                              blocking_fit_holes */
    double spot_error; /* of f, from the scatter between spots [-]; NaN for one spot. Much above standard_error: holes
                          block in patches */
    double low, high;  /* Wilson's interval for f (Wilson 1927), holes independent [-] */
} blocking_count;

/* Computes the free fraction. free_holes[n], holes[n]: counted at n >= 1 spots of the sieve. z: half-width of the
   interval in standard deviations, above 0 .. 1e6, 1.96 for 95 %. BAD_COUNT, TOO_FEW (n 0), BAD_ARGUMENT. */
BLOCKING_API blocking_status blocking_count_holes(const size_t *free_holes, const size_t *holes, size_t n, double z,
                                                  blocking_count *out);

/* ============================================ blocking in time (laws) ============================================= */

/* Returns df/dt = -k1 f + k2 (1 - f) [1/s] (eqs 5, 7, 9, 10). f 0..1; k1: rate constant of blocking, k2: of
   unblocking [1/s] >= 0. */
static inline double blocking_rate(double f, double k1, double k2);

/* Returns the free fraction at time t [s] >= 0 from f0 at t = 0 (eqs 10-13) [-]. f0 0..1, k1, k2 finite >= 0, t may be
   infinite; k1 = k2 = 0 gives f0. It is also the exact step of a simulator: f = blocking_free_fraction(f,
   k1, k2, dt). */
static inline double blocking_free_fraction(double f0, double k1, double k2, double t);
static inline double blocking_pure_blocking(double f0, double k1, double t);   /* eq 6: nothing unblocks */
static inline double blocking_pure_unblocking(double f0, double k2, double t); /* eq 8: nothing blocks */

/* Returns f_inf = k2 / (k1 + k2) (eq 11) [-]; NaN for k1 = k2 = 0, where every f is steady. */
static inline double blocking_equilibrium(double k1, double k2);

/* Below, a curve is (f0, f_inf, k): f(t) = f_inf + (f0 - f_inf) exp(-k t) (eq 13), k = k1 + k2 >= 0 [1/s]. f0 and f_inf
   may be any finite number, so that fitted curves that leave 0..1 can be drawn. */
static inline double blocking_k1(double f_inf, double k);                         /* k (1 - f_inf) [1/s]; f_inf 0..1 */
static inline double blocking_k2(double f_inf, double k);                         /* k f_inf [1/s]; f_inf 0..1 */
static inline double blocking_curve(double f0, double f_inf, double k, double t); /* f at t [s] >= 0 */

/* Returns the mean of f over 0..T [-], T [s] >= 0, may be infinite. This, with T the time between two cleanings, is the
   f* of eq 17; (f0 + f_inf)/2, as in the paper, is not. */
static inline double blocking_time_mean(double f0, double f_inf, double k, double T);

/* Returns the time [s] at which the curve has the value f; 0 for f = f0, NaN for a value that it does not take (f_inf
   is only approached). */
static inline double blocking_time_to(double f, double f0, double f_inf, double k);

/* Returns the integral of f over 0..t [s]: the time in which a clean deck would have passed as much. A screen model's
   curve with blocking is its curve without, taken at this time, if its rate is proportional to the free holes. */
static inline double blocking_exposure(double f0, double f_inf, double k, double t);

/* Returns the time t [s] whose exposure is `exposure` [s] >= 0, f0 and f_inf 0..1; infinite if the deck
   blocks before. */
static inline double blocking_time_for_exposure(double exposure, double f0, double f_inf, double k);

/* ======================================== blocking in time, changing rates ======================================== */

/* k1 and k2 [1/s] >= 0 at time t [s]. */
typedef void blocking_rates_fn(void *user, double t, double *k1, double *k2);

typedef struct blocking_ode_def {
    double f0;                /* free fraction at `start` [-] 0..1; default 1 */
    double start;             /* [s]; default 0 */
    blocking_rates_fn *rates; /* default NULL: must be set */
    void *user;               /* passed to rates; default NULL */
    const double *breaks;     /* [n_breaks] rising times [s] at which rates jump or kink: a step ends there.
                                 default NULL */
    size_t n_breaks;          /* default 0 */
    double tolerance;         /* for the error of f and of its mean, 1e-14 .. 0.1; default 1e-10 */
    double max_step;          /* [s] > 0; infinite (default): none, and unless breaks are given the rates are sampled
                                 all over the time, at 30 (tolerance 1e-3) to 1000 places (1e-10), so that no step jumps
                                 over a pulse longer than two of their gaps, nor over one like those found before; set
                                 it for rare and shorter ones */
    size_t max_steps;         /* >= 1; default 1000000 */
    unsigned cookie;          /* set by blocking_default_ode_def */
} blocking_ode_def;

typedef struct blocking_ode_report {
    size_t steps, rejected, evaluations; /* steps taken, steps repeated smaller, calls of rates */
    double error;                        /* estimate of the error of the last f [-] */
    double time;                         /* where it stopped [s]: the last time, or where it failed */
} blocking_ode_report;

BLOCKING_API blocking_ode_def blocking_default_ode_def(void);
/* Returns OK or BAD_DEF; *field (field may be NULL) names the first bad field, NULL when all is well. The other check
   functions do the same. */
BLOCKING_API blocking_status blocking_check_ode_def(const blocking_ode_def *def, const char **field);

/* Solves df/dt = -k1(t) f + k2(t)(1 - f) (eq 10). times[n]: rising, times[0] >= start. f[n]: free fraction at those
   times; mean[n], or NULL: mean of f from start to there (f0 at start itself). report may be NULL. Every step is exact
   for constant rates and stays within 0..1 for any rates; otherwise order 4 (commutator-free Magnus: Celledoni,
   Marthinsen & Owren 2003), the error from two half steps. Jumps that are not among the breaks are found, at a price:
   see max_step. TOO_FEW, NOT_FINITE, NOT_RISING, BAD_DEF, BAD_RATE, TOO_MANY_STEPS, BAD_ARGUMENT; on failure f and mean
   are NaN from the first time not reached. */
BLOCKING_API blocking_status blocking_integrate(const blocking_ode_def *def, const double *times, size_t n, double *f,
                                                double *mean, blocking_ode_report *report);

/* k1 and k2 [1/s] of a toss indicator and a hard-to-screen content; there is no published law, so this is
   the caller's. */
typedef void blocking_law_fn(void *user, double K, double x_h, double *k1, double *k2);

/* K(t) and x_h(t) as tables. */
typedef struct blocking_schedule {
    const double *time; /* [n] rising [s] */
    const double *K;    /* [n] toss indicator >= 0 */
    const double *x_h;  /* [n] hard-to-screen content of the feed, 0..1 */
    size_t n;           /* >= 1 */
    int stepwise;       /* 1: a value holds until the next time; 0: straight lines between. Before the first and after
                           the last: constant */
    blocking_law_fn *law;
    void *user; /* passed to law */
} blocking_schedule;

/* Returns OK, or what is wrong. *row (may be NULL): the first bad row. */
BLOCKING_API blocking_status blocking_check_schedule(const blocking_schedule *schedule, size_t *row);

/* Returns the rates of a schedule, as a blocking_rates_fn: set def.rates = blocking_schedule_rates,
   def.user = &schedule, def.breaks = schedule.time, def.n_breaks = schedule.n. */
BLOCKING_API void blocking_schedule_rates(void *schedule, double t, double *k1, double *k2);

/* ======================================= rate constants from three readings ======================================= */

#define BLOCKING_TOLERANCE 1e-9 /* the tolerance to give to blocking_three_point */

typedef struct blocking_estimate {
    double f_inf;                          /* as the equation gives it; may lie outside 0..1 [-] */
    double f_inf_clipped;                  /* within 0..1 [-] */
    double f0;                             /* at t = 0 [-]: the first reading, or extrapolated from it */
    double k;                              /* [1/s] */
    double k1, k2;                         /* from k and f_inf_clipped [1/s] */
    double r;                              /* exp(-k (t1 - t0)) [-] */
    double error_f_inf, error_f0, error_k; /* standard errors if the readings have equal, independent errors
                                              sigma; linearised */
} blocking_estimate;

/* Finds the exponential through three readings f[3] (0..1) at any rising times t[3] >= 0 (eqs 14, 15 need 0, t, 2t:
   this does not). sigma: standard error of a reading >= 0 (0: errors come out 0; sqrt(f (1 - f) / holes) for counted
   holes). tolerance >= 0, see BLOCKING_TOLERANCE.
   NO_CHANGE       |f1 - f0| <= tolerance: f_inf = f0 = reading, k NaN
   NON_MONOTONE    the third reading turns back or equals the second: f_inf, k NaN
   NOT_SATURATING  straight or accelerating, r >= 1 - tolerance: f_inf, k NaN
   OUT_OF_RANGE    f_inf (or the extrapolated f0) outside 0..1: all filled, see f_inf_clipped
   and NOT_FINITE (also where a rate would exceed the largest number), NOT_RISING, IN_PERCENT, NEGATIVE, BAD_ARGUMENT.
   An f0 that overflows, with times far from 0, is NaN and OUT_OF_RANGE. */
BLOCKING_API blocking_status blocking_three_point(const double *t, const double *f, double sigma, double tolerance,
                                                  blocking_estimate *out);

/* Return the amplification of noise for readings at 0, t, 2t with r = exp(-k t), 0 < r < 1: the standard error of f_inf
   over that of a reading, and the standard error of ln k times |f0 - f_inf| over that of a reading. The second is
   least, 6.1146, at r = 0.20384: read at t = 1.5904 / k. */
static inline double blocking_noise_f_inf(double r);
static inline double blocking_noise_k(double r);
#define BLOCKING_BEST_KT 1.5904140601732491

/* ======================================== rate constants by least squares ========================================= */

/* Returns the half-width, in standard errors, of a range that holds as much of Student's t with `dof` degrees of
   freedom as -z..z does of the normal distribution: 12.706, 4.303, 3.182, 2.228 for z = 1.959964 and dof 1, 2, 3, 10; z
   itself from dof 1e6 on. z > 0 (above 7 as 7), dof >= 1 (whole numbers; others are rounded down). NaN outside.
   Student 1908. */
BLOCKING_API double blocking_student(double z, double dof);

typedef struct blocking_fit_def {
    double k_low, k_high; /* search range [1/s], 0 < k_low < k_high; default 1e-9, 1e6. The times limit it further, to
                             what they can show: 1e-4 / last time .. 40 / shortest gap */
    double z;             /* confidence of the result's ranges, as half-width in standard deviations of a normal
                             distribution > 0; default 1.96: 95 %. Where the spread is taken from the readings,
                             Student's t is used instead */
    double turn_back;     /* > 0: a reading that runs against the curve by more than this share of the readings' range
                             is NON_MONOTONE; default 0.5 */
    double tolerance;     /* readings that differ by no more than this do not change [-] >= 0; default
                             BLOCKING_TOLERANCE */
    unsigned cookie;      /* set by blocking_default_fit_def */
} blocking_fit_def;

typedef struct blocking_fit_result {
    double f0, f_inf;                      /* [-], both held within 0..1 */
    double k, k1, k2;                      /* [1/s] */
    double sse;                            /* sum of squared deviations, each over its sigma squared if
                                              sigma is given */
    double r2;                             /* 1 - SSE/SST; NaN if SST = 0 */
    double dof;                            /* degrees of freedom of the spread: n - 3; infinite if sigma is given */
    double student;                        /* half-width of the ranges in standard errors: blocking_student(z, dof);
                                              infinite for dof 0 */
    double error_f0, error_f_inf, error_k; /* standard errors, linearised; NaN if dof is 0, and for a value on its
                                              bound: use its range */
    /* Ranges that hold the truth in 95 of 100 cases (def.z): all values with which some curve has a sum of squares
       within student^2 s^2 of the least. They tell more than the errors, which are symmetric. NaN for dof 0, and for
       readings that do not change without sigma. */
    double k_lowest, k_highest;         /* [1/s]; 0 or infinite: open on that side */
    double f0_lowest, f0_highest;       /* [-], cut at 0 and 1 */
    double f_inf_lowest, f_inf_highest; /* [-], cut at 0 and 1 */
    int k_determined;                   /* 1: the range of k ends on both sides; 0: the readings leave k open */
    int f_inf_determined;               /* 1: the range of f_inf is narrower than 0.5; 0: the readings
                                           leave f_inf open */
    int f0_on_bound, f_inf_on_bound;    /* 1: it is 0 or 1 because it is not allowed beyond */
} blocking_fit_result;

BLOCKING_API blocking_fit_def blocking_default_fit_def(void);
BLOCKING_API blocking_status blocking_check_fit_def(const blocking_fit_def *def, const char **field);

/* Fits eq 13 by least squares over k > 0, f0 and f_inf in 0..1 (for a given k the rest is linear: variable projection;
   all minima of a grid in ln k are refined to round-off). t[n] rising >= 0, f[n] 0..1, n >= 3. sigma[n] > 0: standard
   errors of the readings, or NULL: equal and unknown. f0 is that of t = 0: let the clock start with the test, or a
   bound of f0 keeps the curve from the readings. NO_CHANGE, NON_MONOTONE, NOT_SATURATING, NOT_RESOLVED come with the
   best curve filled in (k NaN for NO_CHANGE); TOO_FEW, NOT_FINITE, NOT_RISING, IN_PERCENT, NEGATIVE, BAD_DEF,
   BAD_ARGUMENT with NaN. */
BLOCKING_API blocking_status blocking_fit(const blocking_fit_def *def, const double *t, const double *f,
                                          const double *sigma, size_t n, blocking_fit_result *out);

/* Fits counted holes: free_holes[n] of holes[n] at t[n] [s], n >= 3. The standard errors are those of the curve, sqrt(f
   (1 - f) / holes), not of each reading, with one free and one blocked hole more than there are: near f = 1 those of
   the readings are too small, and the range of f0 then holds the truth in 88 of 100 cases only. f[n], sigma[n]: filled
   with the readings and their errors, for blocking_fit_range and for plots; the caller's. Statuses as blocking_fit;
   BAD_COUNT. Holes that block in patches scatter more: fit f without sigma then. */
BLOCKING_API blocking_status blocking_fit_holes(const blocking_fit_def *def, const double *t, const size_t *free_holes,
                                                const size_t *holes, size_t n, double *f, double *sigma,
                                                blocking_fit_result *out);

/* Computes the ranges, with the confidence of the result's, of f at a time T [s] >= 0 (infinite: f_inf) and of its mean
   over 0..T, which determines the deck's area; both are cut at 0 and 1, and are 0..1 where all curves leave these
   bounds before the first reading. Any of the four may be NULL. The best curve is held within 0..1 from the first
   reading on, not from t = 0: the range of f does not depend on where the clock starts. Statuses as blocking_fit; OK
   also where blocking_fit would name something that is left open: then the range is wide. NO_CHANGE, with NaN, only
   without sigma: equal readings do not tell how well they are known. TOO_FEW also for three readings without sigma. */
BLOCKING_API blocking_status blocking_fit_range(const blocking_fit_def *def, const double *t, const double *f,
                                                const double *sigma, size_t n, double T, double *f_lowest,
                                                double *f_highest, double *mean_lowest, double *mean_highest);

/* =========================================== many tests: k1 and k2 as laws ======================================== */

/* Counted holes of one test. Nothing is owned. */
typedef struct blocking_test {
    const double *t, *f, *sigma; /* [n] as for blocking_fit; sigma may be NULL in all tests together, not in some */
    size_t n;                    /* >= 2 */
    double K, x_h, moisture;     /* [-] finite; if one was not measured, any number that is the same in all tests */
} blocking_test;

enum { BLOCKING_LAW_TERMS = 4 }; /* 1, K, x_h, moisture */

/* ln k1 = a . (1, K, x_h, moisture), ln k2 = b . (1, K, x_h, moisture); which of the terms stand in them is chosen. */
typedef struct blocking_law {
    double a[BLOCKING_LAW_TERMS], b[BLOCKING_LAW_TERMS]; /* 0 where the term is not used; k in 1/s */
    int used_a, used_b;                                  /* bits 1, 2, 4, 8: which terms stand in a, in b
                                                            (bit 1 always) */
    double aicc;            /* Akaike's criterion, corrected for few readings (Hurvich & Tsai 1989); lower is better */
    double aicc_constant;   /* of constant k1 and k2, for comparison: shows what the terms gain */
    double sse, dof, s;     /* sum of squares, degrees of freedom, spread of a reading [-] (1 where sigma is given) */
    double student;         /* of the ranges, for 95 % */
    double low[3], high[3]; /* K, x_h and moisture of the tests: beyond is extrapolation */
    double covariance[2 * BLOCKING_LAW_TERMS][2 * BLOCKING_LAW_TERMS]; /* of a and b; includes the uncertainty from the
                                                                          choice of the form */
    size_t tests, readings;
} blocking_law;

/* Fits one law to the curves of all tests at once, each with its own f0. Of the 64 forms it takes the one with the
   lowest AICc. TOO_FEW (no more readings than coefficients for the simplest form), UNDETERMINED (no form converges),
   and those of blocking_fit. *test (may be NULL): the first bad test. */
BLOCKING_API blocking_status blocking_fit_law(const blocking_test *tests, size_t n_tests, blocking_law *out,
                                              size_t *test);

typedef struct blocking_law_value {
    double k1, k2, f_inf;       /* [1/s] [1/s] [-] */
    double k1_low95, k1_high95; /* 95 % ranges, of the law, without the scatter between tests */
    double k2_low95, k2_high95;
    double f_inf_low95, f_inf_high95;
    int outside; /* bits 1, 2, 4: K, x_h, moisture lie outside the tests by more than 1 % of their range */
} blocking_law_value;

/* Evaluates k1, k2 and f_inf by the law, where no test was made. NOT_FINITE, BAD_ARGUMENT with NaN. */
BLOCKING_API blocking_status blocking_law_at(const blocking_law *law, double K, double x_h, double moisture,
                                             blocking_law_value *out);

typedef struct blocking_law_run {
    double last, mean;              /* f after the run, and its mean over the run [-] */
    double last_low95, last_high95; /* 95 % ranges, of the law, without the scatter between tests: for the same fields
                                       of blocking_duty */
    double mean_low95, mean_high95;
    int outside; /* as in blocking_law_value */
} blocking_law_run;

/* Predicts by the law the free fraction of a deck that begins with f0 (0..1) and runs for T [s] >= 0 (infinite: in the
   long run). The ranges are the lowest and the highest over all k1, k2 that the law's errors allow, so they stay
   within 0..1. Statuses as blocking_law_at. */
BLOCKING_API blocking_status blocking_law_free(const blocking_law *law, double K, double x_h, double moisture,
                                               double f0, double T, blocking_law_run *out);

/* Draws a pair k1, k2 [1/s] within the law's errors: z1, z2 are two standard normal numbers of the caller's, turned
   into errors with the law's covariance (wider by Student's t over 1.96). For results without a formula, such as the
   time to a recovery: draw some hundred pairs, the same seed for the same numbers, and take the range that contains 95
   % of the results. 0, 0 gives the law's own. Statuses as blocking_law_at. */
BLOCKING_API blocking_status blocking_law_draw(const blocking_law *law, double K, double x_h, double moisture,
                                               double z1, double z2, double *k1, double *k2);

/* ========================================== mean free fraction (Table 3) ========================================== */

typedef enum blocking_shape {
    BLOCKING_SPHERICAL,
    BLOCKING_IRREGULAR,
    BLOCKING_SHARP_AS_PRINTED, /* as printed; contradicts Fig 9 and rises above 1.27 */
    BLOCKING_SHARP_REPAIRED,   /* coefficient of x_h^2 -0.373 instead of -0.0373: an inference, see docs/blocking.md */
    BLOCKING_SHAPE_COUNT
} blocking_shape;

BLOCKING_API const char *blocking_shape_text(blocking_shape shape);

/* Returns the bare cubic of Table 3 for f* [-], and its slope by x_h, for any finite K and x_h; NaN for an
   unknown shape. */
static inline double blocking_table3(blocking_shape shape, double K, double x_h);
static inline double blocking_table3_slope(blocking_shape shape, double K, double x_h);

/* Copies its coefficients a[10] in the order K x^2, x^3, x^2, x, K x, K^2 x, 1, K, K^2, K^3 (x = x_h); NaN for an
   unknown shape. */
static inline void blocking_table3_coefficients(blocking_shape shape, double *a);

/* Conditions under which Table 3 was measured. */
typedef struct blocking_conditions {
    double K;                    /* toss indicator [-] >= 0; measured 0.62, 1.5, 1.98, 3.5, 4.9. default
                                    NaN: must be set */
    double x_h;                  /* hard-to-screen content [-] 0..1; default NaN: must be set */
    double opening;              /* size of the hole [m]; measured 0.5e-3 .. 1.2e-3, default 1e-3 */
    double grain_min, grain_max; /* [m]; measured 0.2e-3 .. 2.5e-3, the default */
    double moisture;             /* mass of water over mass of grains [-]; measured and default 0 */
} blocking_conditions;

/* Reasons not to trust a value of Table 3. */
enum blocking_flag {
    BLOCKING_FLAG_K = 1,          /* K outside 0.62..4.9: the cubic diverges */
    BLOCKING_FLAG_OPENING = 2,    /* opening outside 0.5..1.2 mm */
    BLOCKING_FLAG_GRAINS = 4,     /* grains outside 0.2..2.5 mm */
    BLOCKING_FLAG_MOIST = 8,      /* not dry */
    BLOCKING_FLAG_ABOVE_ONE = 16, /* the raw value is above 1 and was cut to 1 */
    BLOCKING_FLAG_NEGATIVE = 32,  /* the raw value is below 0 and was cut to 0 */
    BLOCKING_FLAG_RISING = 64,    /* the polynomial rises with x_h here, which no sieve does: no guide for
                                     an optimiser */
    BLOCKING_FLAG_BOX = 15        /* any of the first four: extrapolation */
};

typedef struct blocking_average {
    double value;   /* f* within 0..1 [-] */
    double raw;     /* as the polynomial gives it [-] */
    double slope;   /* d raw / d x_h [-] */
    unsigned flags; /* of enum blocking_flag */
} blocking_average;

BLOCKING_API blocking_conditions blocking_default_conditions(void);
/* Returns those of the first four flags that apply to a set of conditions. NaN raises its flag. */
BLOCKING_API unsigned blocking_outside_box(const blocking_conditions *conditions);
/* Computes f* and its flags. Model error about +-0.1: f*(K, 0) should be 1 and comes out 0.83 .. 1.08. BLOCKING_OK also
   outside the box: see flags. IN_PERCENT (x_h > 1), NEGATIVE, NOT_FINITE, BAD_ARGUMENT. */
BLOCKING_API blocking_status blocking_average_free(blocking_shape shape, const blocking_conditions *conditions,
                                                   blocking_average *out);
/* Returns the text of one flag; "unknown flag" for anything else. */
BLOCKING_API const char *blocking_flag_text(unsigned flag);

/* ======================================= polynomials of n variables (eq 16) ======================================= */

/* Returns y = sum_i a_i prod_j x_j^P_ij over n_terms terms (the printed sum runs to n, the number of variables: a
   misprint). a[n_terms], powers[n_terms][n_vars] >= 0, x[n_vars]; 0^0 = 1. NaN for a negative power. */
BLOCKING_API double blocking_polynomial(const double *a, const int *powers, size_t n_terms, const double *x,
                                        size_t n_vars);

/* Lists all powers up to a total degree; their number is (n_vars + degree)! / (n_vars! degree!). Returns it, and fills
   powers[number][n_vars] if capacity (rows) is enough; powers may be NULL. Order: by degree, within a degree first
   variable first: 1, x, y, x^2, xy, y^2 ... 0 if n_vars is 0, degree negative or the number above a billion. */
BLOCKING_API size_t blocking_polynomial_powers(size_t n_vars, int degree, int *powers, size_t capacity);

#define BLOCKING_POLYNOMIAL_WORK(n_points, n_terms)                                                                    \
    (((size_t)(n_points) + 4u) * (size_t)(n_terms) + 2u * (size_t)(n_points))

typedef struct blocking_polynomial_report {
    double r2;        /* 1 - SSE/SST; NaN if SST = 0 */
    double sse;       /* sum of squared residuals, in units of y squared */
    double deviation; /* sqrt(SSE / (n_points - n_terms)), units of y; NaN if they are equal */
    size_t term;      /* UNDETERMINED: the first term that the points cannot tell from those before it; else n_terms */
} blocking_polynomial_report;

/* Fits a[n_terms] by least squares from x[n_points][n_vars] and y[n_points] (Householder QR of scaled columns, one
   refinement). error[n_terms], or NULL: standard errors (NaN if n_points = n_terms).
   work[BLOCKING_POLYNOMIAL_WORK(n_points, n_terms)]. report may be NULL. TOO_FEW (n_points < n_terms or n_terms = 0),
   NOT_FINITE, UNDETERMINED (a NaN), BAD_ARGUMENT. */
BLOCKING_API blocking_status blocking_polynomial_fit(const double *x, const double *y, size_t n_points,
                                                     const int *powers, size_t n_terms, size_t n_vars, double *a,
                                                     double *error, double *work, blocking_polynomial_report *report);

/* =================================================== deck area ==================================================== */

/* Returns the clearance of a clean square mesh A0 = (l / (l + w))^2 [-]: holes over screen, opening l [m] > 0,
   wire w [m] >= 0. */
static inline double blocking_open_area(double l, double w);
/* Returns F_ef = f* F A0 (eq 17) [m2]. f_mean 0..1, area F [m2] >= 0, clearance A0 0..1. */
static inline double blocking_effective_area(double f_mean, double area, double clearance);
/* Returns p = F_ef / F = f* A0 (eq 18) [-]. */
static inline double blocking_clearance(double f_mean, double clearance);

/* A deck's duty. Fields whose default is NaN must be set. */
typedef struct blocking_duty {
    double passing;   /* mass of undersize that must pass per time [kg/s] > 0; default NaN */
    double capacity;  /* what passes per area of free holes [kg/(s m2)] > 0, from a clean test deck: passing / (area
                         A0); default NaN */
    double clearance; /* A0 of the clean mesh [-] 0 < A0 <= 1; default NaN */
    double f0, f_inf; /* free fraction just cleaned and in the long run [-] 0..1; default 1, NaN */
    double k;         /* k1 + k2 [1/s] >= 0; default NaN */
    double run_time;  /* between two cleanings [s] >= 0, infinite: never cleaned. default infinite */
    /* What the free fraction's range is, where it is known: blocking_fit_range at run_time gives both. Default
       NaN: not known */
    double mean_lowest, mean_highest; /* of the mean over run_time [-] 0..1 */
    double last_lowest, last_highest; /* of f at run_time [-] 0..1 */
    unsigned cookie;                  /* set by blocking_default_duty */
} blocking_duty;

typedef struct blocking_deck {
    double free_mean, free_lowest;            /* f over the run: its mean, and its lowest value [-] */
    double effective_area;                    /* free holes needed, passing / capacity [m2] */
    double area_clean;                        /* deck needed if nothing blocked [m2] */
    double area_mean;                         /* ... to pass the duty on average over the run (eqs 17, 18 with
                                                 f* = free_mean) [m2] */
    double area_lowest;                       /* ... to pass the duty at every moment of the run [m2] */
    double area_mean_low95, area_mean_high95; /* 95 % range of area_mean [m2]; NaN if the duty has no ranges, infinite:
                                                 no area is enough */
    double area_lowest_low95, area_lowest_high95; /* the same of area_lowest */
} blocking_deck;

BLOCKING_API blocking_duty blocking_default_duty(void);
BLOCKING_API blocking_status blocking_check_duty(const blocking_duty *duty, const char **field);
/* Computes how large a deck must be. Areas are infinite where everything blocks. BAD_DEF, BAD_ARGUMENT. */
BLOCKING_API blocking_status blocking_design(const blocking_duty *duty, blocking_deck *out);

/* clang-format off */
/* >>portable-math: exp, log, sin and related functions with the same bits on every machine; those of libm differ.
   Identical in every Riddle header that needs it (base/portable_math.h is the master, tests/check_headers compares the
   copies). Within 5 ulp unless stated; NaN outside the domain. */
/* clang-format off */
#ifndef RIDDLE_PORTABLE_MATH
#define RIDDLE_PORTABLE_MATH
#define RIDDLE_PI 3.14159265358979323846
#define RIDDLE_LN2_HI 0.6931471803691238   /* first 32 bits of ln 2, so that k * LN2_HI is exact for |k| < 2^20 */
#define RIDDLE_LN2_LO 1.9082149292705877e-10

/* Returns exp(r) - 1 for |r| < 0.36: Taylor series to r^14. */
static inline double riddle__expm1_small(double r) {
    double p = 1.0 / 87178291200.0;
    p = p * r + 1.0 / 6227020800.0;
    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    return r + r * r * p;
}

static inline double riddle_exp(double x) {
    if (!(x > -745.2)) return x != x ? x : 0.0;
    if (x > 709.79) return HUGE_VAL;
    double k = floor(x * 1.4426950408889634 + 0.5);
    double r = (x - k * RIDDLE_LN2_HI) - k * RIDDLE_LN2_LO;
    return ldexp(1.0 + riddle__expm1_small(r), (int)k);
}

static inline double riddle_expm1(double x) { return fabs(x) < 0.35 ? riddle__expm1_small(x) : riddle_exp(x) - 1.0; }

/* Returns log(1 + f) for -0.3 <= f <= 0.42: 2 atanh(s) with s = f / (2 + f). */
static inline double riddle__log1p_small(double f) {
    double s = f / (2.0 + f), z = s * s, p = 2.0 / 23.0;
    p = p * z + 2.0 / 21.0;
    p = p * z + 2.0 / 19.0;
    p = p * z + 2.0 / 17.0;
    p = p * z + 2.0 / 15.0;
    p = p * z + 2.0 / 13.0;
    p = p * z + 2.0 / 11.0;
    p = p * z + 2.0 / 9.0;
    p = p * z + 2.0 / 7.0;
    p = p * z + 2.0 / 5.0;
    p = p * z + 2.0 / 3.0;
    return f - s * (f - z * p);
}

static inline double riddle_log(double x) {
    if (!(x > 0.0)) return x == 0.0 ? -HUGE_VAL : (double)NAN;
    if (x > 1.7976931348623157e308) return x;
    int e;
    double m = frexp(x, &e);
    if (m < 0.70710678118654752) {
        m *= 2.0;
        e -= 1;
    }
    return e * RIDDLE_LN2_HI + (riddle__log1p_small(m - 1.0) + e * RIDDLE_LN2_LO);
}

static inline double riddle_log1p(double x) {
    return x > -0.29 && x < 0.4 ? riddle__log1p_small(x) : riddle_log(1.0 + x);
}

/* Returns x^y for x >= 0; relative error about (2 + |y log x|) ulp. */
static inline double riddle_pow(double x, double y) {
    if (y == 0.0 || x == 1.0) return 1.0;
    return riddle_exp(y * riddle_log(x));
}

static inline double riddle_cbrt(double x) {
    if (x == 0.0 || !(fabs(x) <= 1.7976931348623157e308)) return x;
    int e;
    double m = frexp(fabs(x), &e); /* in [0.5, 1) */
    int third = (e + 3000) / 3 - 1000, rest = e - 3 * third;
    m = ldexp(m, rest); /* in [0.5, 4) */
    double y = 0.65 + 0.25 * m;
    for (int i = 0; i < 5; i++) y -= (y * y * y - m) / (3.0 * y * y);
    return ldexp(x < 0.0 ? -y : y, third);
}

/* Returns the sine of r + quarter turns for |r| <= pi/4. */
static inline double riddle__sin_quarter(double r, int quarter) {
    double z = r * r, p, value;
    if (quarter & 1) {
        p = -1.0 / 6402373705728000.0;
        p = p * z + 1.0 / 20922789888000.0;
        p = p * z - 1.0 / 87178291200.0;
        p = p * z + 1.0 / 479001600.0;
        p = p * z - 1.0 / 3628800.0;
        p = p * z + 1.0 / 40320.0;
        p = p * z - 1.0 / 720.0;
        p = p * z + 1.0 / 24.0;
        value = 1.0 - (0.5 * z - z * z * p);
    } else {
        p = 1.0 / 355687428096000.0;
        p = p * z - 1.0 / 1307674368000.0;
        p = p * z + 1.0 / 6227020800.0;
        p = p * z - 1.0 / 39916800.0;
        p = p * z + 1.0 / 362880.0;
        p = p * z - 1.0 / 5040.0;
        p = p * z + 1.0 / 120.0;
        p = p * z - 1.0 / 6.0;
        value = r + r * z * p;
    }
    return quarter & 2 ? -value : value;
}

/* Returns an angle less its quarter turns, and the number of these modulo 4. */
static inline double riddle__within_quarter(double x, int *quarter) {
    *quarter = 0;
    if (!(fabs(x) <= 1e6)) return (double)NAN;
    double n = floor(x * 0.63661977236758134 + 0.5);
    *quarter = (int)(n - 4.0 * floor(n * 0.25));
    return ((x - n * 1.5707963267341256) - n * 6.077100506303966e-11) - n * 2.0222662487959506e-21;
}

/* Returns the sine of an angle to which some quarter turns are added. */
static inline double riddle__sin_shifted(double x, int quarters) {
    int quarter;
    double r = riddle__within_quarter(x, &quarter);
    return riddle__sin_quarter(r, quarter + quarters);
}

/* Return the sine and the cosine for |x| <= 1e6 rad, NaN beyond; absolute error 2e-16. */
static inline double riddle_sin(double x) { return riddle__sin_shifted(x, 0); }
static inline double riddle_cos(double x) { return riddle__sin_shifted(x, 1); }

static inline double riddle_atan(double x) {
    double t = fabs(x), base = 0.0, sign = 1.0;
    if (t > 1.0) {
        t = 1.0 / t;
        base = 0.5 * RIDDLE_PI;
        sign = -1.0;
    }
    if (t > 0.26794919243112270) {
        base += sign * (RIDDLE_PI / 6.0);
        t = (1.7320508075688773 * t - 1.0) / (t + 1.7320508075688773);
    }
    double z = t * t, p = 0.0;
    for (int k = 15; k > 0; k--) p = z * (1.0 / (2 * k + 1) - p);
    double value = base + sign * (t - t * p);
    return x < 0.0 ? -value : value;
}

static inline double riddle_atan2(double y, double x) {
    if (x == 0.0 && y == 0.0) return 0.0;
    if (x != x || y != y) return (double)NAN;
    if (fabs(y) > fabs(x)) return (y > 0.0 ? 0.5 : -0.5) * RIDDLE_PI - riddle_atan(x / y);
    return riddle_atan(y / x) + (x < 0.0 ? (y < 0.0 ? -RIDDLE_PI : RIDDLE_PI) : 0.0);
}

static inline double riddle_acos(double x) {
    return fabs(x) <= 1.0 ? riddle_atan2(sqrt((1.0 - x) * (1.0 + x)), x) : (double)NAN;
}

static inline double riddle_asin(double x) {
    return fabs(x) <= 1.0 ? riddle_atan2(x, sqrt((1.0 - x) * (1.0 + x))) : (double)NAN;
}
#endif /* RIDDLE_PORTABLE_MATH */
/* clang-format on */
/* <<portable-math */
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
/* clang-format on */

/* ===================================================== >>laws ===================================================== */

static inline int blocking__within(double x, double low, double high) { return x >= low && x <= high; }
static inline int blocking__finite(double x) { return fabs(x) <= 1.7976931348623157e308; }
static inline double blocking__clip(double x, double low, double high) { return x < low ? low : x > high ? high : x; }
static inline double blocking__square(double x) { return x * x; }

/* Ends of printed intervals are decimals (0.96 mm / 1.2 mm): a rounding must not push one out. */
#define BLOCKING__EDGE 1e-15

static inline double blocking_relative_size(double d, double l) {
    return d >= 0.0 && blocking__finite(d) && l > 0.0 && blocking__finite(l) ? d / l : (double)NAN;
}

static inline int blocking_is_hard_to_screen(double phi) {
    return blocking__within(phi, 0.8 - BLOCKING__EDGE, 1.2 + BLOCKING__EDGE);
}

/* Returns the normal acceleration of the deck over gravity, for a normal amplitude of 1 m and n = 1 Hz; alpha [rad]. */
static inline double blocking__toss_factor(double alpha, double g) {
    double c = riddle_cos(alpha);
    return c > BLOCKING__EDGE && g > 0.0 && blocking__finite(g) ? 4.0 * RIDDLE_PI * RIDDLE_PI / (g * c) : (double)NAN;
}

static inline double blocking_toss_indicator(double n, double A, double beta, double alpha, double g) {
    if (!(n >= 0.0 && A >= 0.0 && blocking__within(beta, 0.0, RIDDLE_PI))) return (double)NAN;
    return blocking__toss_factor(alpha, g) * n * n * A * fabs(riddle_sin(beta));
}

static inline double blocking_toss_amplitude(double K, double n, double alpha, double g) {
    if (!(K >= 0.0 && n > 0.0)) return (double)NAN;
    return K / (blocking__toss_factor(alpha, g) * n * n);
}

static inline double blocking_toss_frequency(double K, double A, double beta, double alpha, double g) {
    double normal = A * riddle_sin(beta);
    if (!(K >= 0.0 && A > 0.0 && normal > A * BLOCKING__EDGE)) return (double)NAN;
    return sqrt(K / (blocking__toss_factor(alpha, g) * normal));
}

static inline blocking_toss blocking_toss_range(double K) {
    const double edge = 8.0 * BLOCKING__EDGE;
    if (!(K >= 0.0)) return BLOCKING_TOSS_UNDEFINED;
    if (K < 1.0) return BLOCKING_TOSS_NONE;
    if (blocking__within(K, 2.0 - edge, 3.3 + edge)) return BLOCKING_TOSS_EASY;
    if (blocking__within(K, 4.5 - edge, 6.5 + edge)) return BLOCKING_TOSS_AVERAGE;
    if (blocking__within(K, 7.0 - edge, 10.0 + edge)) return BLOCKING_TOSS_HARD;
    return BLOCKING_TOSS_UNLISTED;
}

static inline int blocking_bed_too_thick(double H, double D_z) {
    return !(H >= 0.0 && D_z > 0.0 && H / D_z < 0.1 - BLOCKING__EDGE);
}

static inline double blocking_rate(double f, double k1, double k2) {
    if (!(blocking__within(f, 0.0, 1.0) && k1 >= 0.0 && k2 >= 0.0)) return (double)NAN;
    return k2 * (1.0 - f) - k1 * f;
}

static inline double blocking_curve(double f0, double f_inf, double k, double t) {
    if (!(blocking__finite(f0) && blocking__finite(f_inf) && k >= 0.0 && blocking__finite(k) && t >= 0.0))
        return (double)NAN;
    if (k == 0.0) return f0;
    double x = k * t;
    /* each form where it loses nothing: the first keeps small changes, the second small values */
    double f = x < 0.5 ? f0 - (f_inf - f0) * riddle_expm1(-x) : f_inf + (f0 - f_inf) * riddle_exp(-x);
    return f0 < f_inf ? blocking__clip(f, f0, f_inf) : blocking__clip(f, f_inf, f0);
}

static inline double blocking_equilibrium(double k1, double k2) {
    double k = k1 + k2;
    if (!(k1 >= 0.0 && k2 >= 0.0 && k > 0.0)) return (double)NAN;
    return blocking__finite(k) ? k2 / k : 0.5 * k2 / (0.5 * k1 + 0.5 * k2); /* the sum of finite rates may overflow */
}

static inline double blocking_free_fraction(double f0, double k1, double k2, double t) {
    if (!(blocking__within(f0, 0.0, 1.0) && k1 >= 0.0 && k2 >= 0.0)) return (double)NAN;
    double k = k1 + k2;
    if (!blocking__finite(k)) return blocking_curve(f0, blocking_equilibrium(k1, k2), 0.5 * k1 + 0.5 * k2, 2.0 * t);
    return blocking_curve(f0, k > 0.0 ? k2 / k : f0, k, t);
}

static inline double blocking_pure_blocking(double f0, double k1, double t) {
    return blocking_free_fraction(f0, k1, 0.0, t);
}
static inline double blocking_pure_unblocking(double f0, double k2, double t) {
    return blocking_free_fraction(f0, 0.0, k2, t);
}

static inline double blocking_k1(double f_inf, double k) {
    return blocking__within(f_inf, 0.0, 1.0) && k >= 0.0 ? k * (1.0 - f_inf) : (double)NAN;
}
static inline double blocking_k2(double f_inf, double k) {
    return blocking__within(f_inf, 0.0, 1.0) && k >= 0.0 ? k * f_inf : (double)NAN;
}

/* Returns 1 - (1 - e^-x)/x for x >= 0: the share of the way from its start to its end that the mean over 0..x
   has covered. */
static inline double blocking__mean_share(double x) {
    if (x >= 0.5) return 1.0 + riddle_expm1(-x) / x;
    double p = 1.0;
    for (int i = 16; i >= 3; i--) p = 1.0 - x / i * p;
    return 0.5 * x * p;
}

static inline double blocking_time_mean(double f0, double f_inf, double k, double T) {
    if (!(blocking__finite(f0) && blocking__finite(f_inf) && k >= 0.0 && blocking__finite(k) && T >= 0.0))
        return (double)NAN;
    if (k == 0.0) return f0;
    double x = k * T;
    double mean = x < 0.5 ? f0 + (f_inf - f0) * blocking__mean_share(x) : f_inf - (f0 - f_inf) * (riddle_expm1(-x) / x);
    return f0 < f_inf ? blocking__clip(mean, f0, f_inf) : blocking__clip(mean, f_inf, f0);
}

static inline double blocking_time_to(double f, double f0, double f_inf, double k) {
    if (!(blocking__finite(f) && blocking__finite(f0) && blocking__finite(f_inf) && k >= 0.0 && blocking__finite(k)))
        return (double)NAN;
    if (f == f0) return 0.0;
    double gone = (f0 - f) / (f - f_inf);
    return k > 0.0 && gone > 0.0 && blocking__finite(gone) ? riddle_log1p(gone) / k : (double)NAN;
}

static inline double blocking_exposure(double f0, double f_inf, double k, double t) {
    double mean = blocking_time_mean(f0, f_inf, k, t);
    if (mean == 0.0 && !blocking__finite(t)) return k > 0.0 ? f0 / k : 0.0;
    /* the mean's share of f0 underflows */
    if (k * t > 1e100 && blocking__finite(t)) return f_inf * t + (f0 - f_inf) / k;
    return mean * t;
}

/* Returns a root of g between a and b, where g has different signs, to the last bits (Chandrupatla 1997). */
static inline double blocking__root(double (*g)(const void *, double), const void *data, double a, double b) {
    double ga = g(data, a), gb = g(data, b), c = a, gc = ga, share = 0.5;
    if (ga == 0.0) return a;
    if (gb == 0.0) return b;
    for (int i = 0; i < 200; i++) {
        double x = a + share * (b - a), gx = g(data, x);
        if ((gx < 0.0) == (ga < 0.0)) {
            c = a;
            gc = ga;
        } else {
            c = b;
            gc = gb;
            b = a;
            gb = ga;
        }
        a = x;
        ga = gx;
        double best = fabs(ga) < fabs(gb) ? a : b;
        double least = 2.3e-16 * fabs(best) / fabs(b - a);
        if (ga == 0.0 || !(least < 0.5)) return best;
        double xi = (a - b) / (c - b), phi = (ga - gb) / (gc - gb);
        share = 0.5;
        if (phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi)
            share = ga / (gb - ga) * (gc / (gb - gc)) + (c - a) / (b - a) * (ga / (gc - ga)) * (gb / (gc - gb));
        share = blocking__clip(share, least, 1.0 - least);
    }
    return fabs(ga) < fabs(gb) ? a : b;
}

typedef struct blocking__exposed {
    double f0, f_inf, k, exposure;
} blocking__exposed;

static inline double blocking__exposure_miss(const void *data, double t) {
    const blocking__exposed *e = (const blocking__exposed *)data;
    return blocking_exposure(e->f0, e->f_inf, e->k, t) - e->exposure;
}

static inline double blocking_time_for_exposure(double exposure, double f0, double f_inf, double k) {
    if (!(exposure >= 0.0 && blocking__within(f0, 0.0, 1.0) && blocking__within(f_inf, 0.0, 1.0) && k >= 0.0 &&
          blocking__finite(k)))
        return (double)NAN;
    if (exposure == 0.0) return 0.0;
    if (k == 0.0 || f0 == f_inf || !blocking__finite(exposure)) return exposure / fabs(f0);
    if (f_inf == 0.0) return k * exposure < f0 ? -riddle_log1p(-k * exposure / f0) / k : HUGE_VAL;
    double rise = f_inf > f0 ? f_inf - f0 : 0.0;
    double low = exposure / (rise > 0.0 ? f_inf : f0);
    double high = (exposure + rise / k) / f_inf;
    if (f0 > 0.0) {
        double slowest = exposure / (rise > 0.0 ? f0 : f_inf);
        if (slowest < high) high = slowest;
    }
    if (rise > 0.0) { /* 1 - e^-x > 0.63 x below x = 1 keeps the bracket short for slow curves */
        double early = sqrt(exposure / (0.316 * rise * k));
        if (k * early <= 1.0 && early < high) high = early;
    }
    blocking__exposed e;
    e.f0 = f0;
    e.f_inf = f_inf;
    e.k = k;
    e.exposure = exposure;
    if (!(low < high) || !(blocking__exposure_miss(&e, low) < 0.0)) return low;
    if (!(blocking__exposure_miss(&e, high) > 0.0)) return high;
    return blocking__root(blocking__exposure_miss, &e, low, high);
}

static inline double blocking_noise_f_inf(double r) {
    if (!(r > 0.0 && r < 1.0)) return (double)NAN;
    return sqrt(r * r * (r * r + 4.0) + 1.0) / ((1.0 - r) * (1.0 - r));
}

static inline double blocking_noise_k(double r) {
    if (!(r > 0.0 && r < 1.0)) return (double)NAN;
    return sqrt(2.0 * (1.0 + r + r * r)) / (r * (1.0 - r) * -riddle_log(r));
}

/* f = c00 + K (c10 + K (c20 + K c30)) + x (c01 + K (c11 + K c21) + x (c02 + K c12 + x c03)) */
typedef struct blocking__cubic {
    double c12, c03, c02, c01, c11, c21, c00, c10, c20, c30; /* in the order of the print */
} blocking__cubic;

static inline blocking__cubic blocking__table3_row(blocking_shape shape) {
    const blocking__cubic spherical = {-0.211, 0.58, -0.033, -1.04, 0.439, -0.025, 0.945, 0.192, -0.082, 0.009};
    const blocking__cubic irregular = {-0.1, -0.284, 0.972, -1.087, 0.192, -0.00804, 0.709, 0.415, -0.144, 0.015};
    const blocking__cubic printed = {-0.086, 0.57, -0.0373, -0.438, 0.031, 0.018, 0.633, 0.4, -0.13, 0.013};
    const blocking__cubic repaired = {-0.086, 0.57, -0.373, -0.438, 0.031, 0.018, 0.633, 0.4, -0.13, 0.013};
    const double u = (double)NAN;
    const blocking__cubic unknown = {u, u, u, u, u, u, u, u, u, u};
    switch (shape) {
    case BLOCKING_SPHERICAL: return spherical;
    case BLOCKING_IRREGULAR: return irregular;
    case BLOCKING_SHARP_AS_PRINTED: return printed;
    case BLOCKING_SHARP_REPAIRED: return repaired;
    case BLOCKING_SHAPE_COUNT: break;
    }
    return unknown;
}

static inline double blocking_table3(blocking_shape shape, double K, double x_h) {
    const blocking__cubic c = blocking__table3_row(shape);
    return c.c00 + K * (c.c10 + K * (c.c20 + K * c.c30)) +
           x_h * (c.c01 + K * (c.c11 + K * c.c21) + x_h * (c.c02 + K * c.c12 + x_h * c.c03));
}

static inline double blocking_table3_slope(blocking_shape shape, double K, double x_h) {
    const blocking__cubic c = blocking__table3_row(shape);
    return c.c01 + K * (c.c11 + K * c.c21) + x_h * (2.0 * (c.c02 + K * c.c12) + 3.0 * x_h * c.c03);
}

static inline void blocking_table3_coefficients(blocking_shape shape, double *a) {
    const blocking__cubic c = blocking__table3_row(shape);
    a[0] = c.c12;
    a[1] = c.c03;
    a[2] = c.c02;
    a[3] = c.c01;
    a[4] = c.c11;
    a[5] = c.c21;
    a[6] = c.c00;
    a[7] = c.c10;
    a[8] = c.c20;
    a[9] = c.c30;
}

static inline double blocking_open_area(double l, double w) {
    return l > 0.0 && blocking__finite(l) && w >= 0.0 && blocking__finite(w) ? blocking__square(l / (l + w))
                                                                             : (double)NAN;
}

static inline double blocking_clearance(double f_mean, double clearance) {
    return blocking__within(f_mean, 0.0, 1.0) && blocking__within(clearance, 0.0, 1.0) ? f_mean * clearance
                                                                                       : (double)NAN;
}

static inline double blocking_effective_area(double f_mean, double area, double clearance) {
    return area >= 0.0 ? blocking_clearance(f_mean, clearance) * area : (double)NAN;
}

#ifdef BLOCKING__BODIES

/* ==================================================== >>status ==================================================== */

#define BLOCKING__CASE(name, text)                                                                                     \
    case name: return text;

BLOCKING_API const char *blocking_status_text(blocking_status status) {
    switch (status) {
        BLOCKING_STATUSES(BLOCKING__CASE)
    case BLOCKING_STATUS_COUNT: break;
    }
    return "unknown status";
}

BLOCKING_API const char *blocking_toss_text(blocking_toss range) {
    switch (range) {
        BLOCKING_TOSSES(BLOCKING__CASE)
    case BLOCKING_TOSS_COUNT: break;
    }
    return "unknown range";
}
#undef BLOCKING__CASE

BLOCKING_API const char *blocking_shape_text(blocking_shape shape) {
    switch (shape) {
    case BLOCKING_SPHERICAL: return "spherical";
    case BLOCKING_IRREGULAR: return "irregular";
    case BLOCKING_SHARP_AS_PRINTED: return "sharp-edged (as printed)";
    case BLOCKING_SHARP_REPAIRED: return "sharp-edged (repaired)";
    case BLOCKING_SHAPE_COUNT: break;
    }
    return "unknown shape";
}

BLOCKING_API const char *blocking_flag_text(unsigned flag) {
    switch (flag) {
    case BLOCKING_FLAG_K: return "K outside the measured 0.62..4.9";
    case BLOCKING_FLAG_OPENING: return "opening outside the measured 0.5..1.2 mm";
    case BLOCKING_FLAG_GRAINS: return "grains outside the measured 0.2..2.5 mm";
    case BLOCKING_FLAG_MOIST: return "measured with dry grains only";
    case BLOCKING_FLAG_ABOVE_ONE: return "the polynomial is above 1 here, cut to 1";
    case BLOCKING_FLAG_NEGATIVE: return "the polynomial is below 0 here, cut to 0";
    case BLOCKING_FLAG_RISING: return "the polynomial rises with x_h here";
    default: return "unknown flag";
    }
}

static inline blocking_status blocking__check_fraction(double x) {
    if (!blocking__finite(x)) return BLOCKING_NOT_FINITE;
    return x < 0.0 ? BLOCKING_NEGATIVE : x > 1.0 ? BLOCKING_IN_PERCENT : BLOCKING_OK;
}

static inline blocking_status blocking__check_rising(const double *x, size_t n) {
    for (size_t i = 0; i < n; i++) {
        if (!blocking__finite(x[i])) return BLOCKING_NOT_FINITE;
        if (i > 0 && !(x[i] > x[i - 1])) return BLOCKING_NOT_RISING;
    }
    return BLOCKING_OK;
}

static inline blocking_status blocking__check_readings(const double *t, const double *f, size_t n) {
    blocking_status status = blocking__check_rising(t, n);
    if (status != BLOCKING_OK) return status;
    if (t[0] < 0.0) return BLOCKING_NOT_RISING;
    for (size_t i = 0; i < n && status == BLOCKING_OK; i++) status = blocking__check_fraction(f[i]);
    return status;
}

/* ==================================================== >>grains ==================================================== */

BLOCKING_API blocking_status blocking_hard_from_classes(const double *diameter, const double *mass, size_t n,
                                                        double opening, blocking_hard *out) {
    if (!out) return BLOCKING_BAD_ARGUMENT;
    out->x_h = out->below = out->above = (double)NAN;
    if (!blocking__finite(opening)) return BLOCKING_NOT_FINITE;
    if ((n > 0 && (!diameter || !mass)) || !(opening > 0.0)) return BLOCKING_BAD_ARGUMENT;
    double total = 0.0, below = 0.0, above = 0.0;
    for (size_t i = 0; i < n; i++) {
        if (!blocking__finite(diameter[i]) || !blocking__finite(mass[i])) return BLOCKING_NOT_FINITE;
        if (!(diameter[i] > 0.0) || mass[i] < 0.0) return BLOCKING_NEGATIVE;
        double phi = diameter[i] / opening;
        total += mass[i];
        if (!blocking_is_hard_to_screen(phi)) continue;
        if (phi <= 1.0 + BLOCKING__EDGE) below += mass[i];
        else above += mass[i];
    }
    if (!blocking__finite(total)) return BLOCKING_NOT_FINITE;
    if (!(total > 0.0)) return BLOCKING_TOO_FEW;
    out->below = below / total;
    out->above = above / total;
    out->x_h = out->below + out->above;
    return BLOCKING_OK;
}

/* Interpolates linearly between the points, or by steps; constant outside. */
static inline double blocking__interpolate(const double *x, const double *y, size_t n, double at, int stepwise) {
    if (!(at > x[0])) return y[0];
    if (!(at < x[n - 1])) return y[n - 1];
    size_t low = 0, high = n - 1;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (x[middle] <= at) low = middle;
        else high = middle;
    }
    return stepwise ? y[low] : y[low] + (y[high] - y[low]) * ((at - x[low]) / (x[high] - x[low]));
}

BLOCKING_API blocking_status blocking_hard_from_curve(const double *size, const double *passing, size_t n,
                                                      double opening, blocking_hard *out) {
    if (!out) return BLOCKING_BAD_ARGUMENT;
    out->x_h = out->below = out->above = (double)NAN;
    if (!blocking__finite(opening)) return BLOCKING_NOT_FINITE;
    if ((n > 0 && (!size || !passing)) || !(opening > 0.0)) return BLOCKING_BAD_ARGUMENT;
    if (n < 2) return BLOCKING_TOO_FEW;
    blocking_status status = blocking__check_rising(size, n);
    if (status != BLOCKING_OK) return status;
    if (size[0] < 0.0) return BLOCKING_NEGATIVE;
    for (size_t i = 0; i < n; i++) {
        status = blocking__check_fraction(passing[i]);
        if (status != BLOCKING_OK) return status;
        if (i > 0 && passing[i] < passing[i - 1]) return BLOCKING_NOT_CUMULATIVE;
    }
    const double finest = 0.8 * opening, coarsest = 1.2 * opening, edge = 4.0 * BLOCKING__EDGE;
    if ((finest < size[0] * (1.0 - edge) && passing[0] > 0.0) ||
        (coarsest > size[n - 1] * (1.0 + edge) && passing[n - 1] < 1.0 - edge))
        return BLOCKING_NOT_COVERED;
    double at = blocking__interpolate(size, passing, n, opening, 0);
    out->below = at - blocking__interpolate(size, passing, n, finest, 0);
    out->above = blocking__interpolate(size, passing, n, coarsest, 0) - at;
    out->x_h = out->below + out->above;
    return BLOCKING_OK;
}

BLOCKING_API blocking_status blocking_count_holes(const size_t *free_holes, const size_t *holes, size_t n, double z,
                                                  blocking_count *out) {
    if (!out) return BLOCKING_BAD_ARGUMENT;
    out->free_fraction = out->blocked = out->standard_error = out->spot_error = out->low = out->high = (double)NAN;
    if ((n > 0 && (!free_holes || !holes)) || !(z > 0.0 && z <= 1e6)) return BLOCKING_BAD_ARGUMENT;
    if (n == 0) return BLOCKING_TOO_FEW;
    double counted = 0.0, all = 0.0, spots = 0.0, scatter = 0.0;
    for (size_t i = 0; i < n; i++) {
        if (holes[i] == 0 || free_holes[i] > holes[i]) return BLOCKING_BAD_COUNT;
        counted += (double)free_holes[i];
        all += (double)holes[i];
        spots += (double)free_holes[i] / (double)holes[i] / (double)n;
    }
    for (size_t i = 0; i < n; i++) scatter += blocking__square((double)free_holes[i] / (double)holes[i] - spots);
    double f = counted / all, zz = z * z / all;
    double centre = (f + 0.5 * zz) / (1.0 + zz), half = z / (1.0 + zz) * sqrt(f * (1.0 - f) / all + 0.25 * zz / all);
    out->free_fraction = f;
    out->blocked = (all - counted) / all;
    out->standard_error = sqrt(f * (1.0 - f) / all);
    if (n > 1) out->spot_error = sqrt(scatter / ((double)n - 1.0) / (double)n);
    out->low = counted > 0.0 ? blocking__clip(centre - half, 0.0, 1.0) : 0.0; /* rounding */
    out->high = counted < all ? blocking__clip(centre + half, 0.0, 1.0) : 1.0;
    return BLOCKING_OK;
}

/* ===================================================== >>ode ====================================================== */

#define BLOCKING__COOKIE_ODE 0x0b10c0deu
#define BLOCKING__COOKIE_FIT 0x0b10cf17u
#define BLOCKING__COOKIE_DUTY 0x0b10cd07u

BLOCKING_API blocking_ode_def blocking_default_ode_def(void) {
    blocking_ode_def def;
    def.f0 = 1.0;
    def.start = 0.0;
    def.rates = NULL;
    def.user = NULL;
    def.breaks = NULL;
    def.n_breaks = 0;
    def.tolerance = 1e-10;
    def.max_step = HUGE_VAL;
    def.max_steps = 1000000;
    def.cookie = BLOCKING__COOKIE_ODE;
    return def;
}

BLOCKING_API blocking_status blocking_check_ode_def(const blocking_ode_def *def, const char **field) {
    const char *bad = NULL;
    if (!def) bad = "def";
    else if (def->cookie != BLOCKING__COOKIE_ODE) bad = "cookie";
    else if (!blocking__within(def->f0, 0.0, 1.0)) bad = "f0";
    else if (!blocking__finite(def->start)) bad = "start";
    else if (!def->rates) bad = "rates";
    else if (def->n_breaks > 0 && (!def->breaks || blocking__check_rising(def->breaks, def->n_breaks) != BLOCKING_OK))
        bad = "breaks";
    else if (!blocking__within(def->tolerance, 1e-14, 0.1)) bad = "tolerance";
    else if (!(def->max_step > 0.0)) bad = "max_step";
    else if (def->max_steps < 1) bad = "max_steps";
    if (field) *field = bad;
    return bad ? BLOCKING_BAD_DEF : BLOCKING_OK;
}

typedef struct blocking__rates {
    double k1, k2;
} blocking__rates;

/* Places at which rates are sampled between start and end. */
static inline double blocking__samples(double tolerance) {
    return floor(7.0 * riddle_exp(-0.2155 * riddle_log(tolerance)));
}

typedef struct blocking__state {
    double f, integral, turnover; /* integrals since the start: of f, and of k1 + k2 */
} blocking__state;

/* Jumps that were found between breaks: where rates jump twice within a time they are expected to do so again. */
typedef struct blocking__jumps {
    double last, longest_step; /* [s]; longest_step: a quarter of the shortest time between two jumps so far */
} blocking__jumps;

static inline int blocking__rates_at(const blocking_ode_def *def, double t, blocking__rates *r,
                                     blocking_ode_report *report) {
    r->k1 = r->k2 = (double)NAN;
    def->rates(def->user, t, &r->k1, &r->k2);
    report->evaluations++;
    return blocking__within(r->k1, 0.0, 1e300) && blocking__within(r->k2, 0.0, 1e300);
}

/* Advances the state by h at constant rates, exactly. */
static inline blocking__state blocking__advance(blocking__state s, double k1, double k2, double h) {
    double k = k1 + k2, f_inf = k > 0.0 ? k2 / k : s.f;
    blocking__state next;
    next.f = blocking_curve(s.f, f_inf, k, h);
    next.integral = s.integral + h * blocking_time_mean(s.f, f_inf, k, h);
    next.turnover = s.turnover + h * k;
    return next;
}

/* Makes one step of the commutator-free Magnus method of order 4 with the moments from Simpson's rule: two exact half
   steps with mixed rates. A mixture is negative only where rates grow by more than a factor 3 within the step; cutting
   it off keeps f within 0..1, and the error control accounts for the rest. */
static inline blocking__state blocking__magnus(blocking__state s, blocking__rates a, blocking__rates m,
                                               blocking__rates b, double h) {
    const double sixth = 1.0 / 6.0;
    s = blocking__advance(s, blocking__clip(sixth * (3.0 * a.k1 + 4.0 * m.k1 - b.k1), 0.0, HUGE_VAL),
                          blocking__clip(sixth * (3.0 * a.k2 + 4.0 * m.k2 - b.k2), 0.0, HUGE_VAL), 0.5 * h);
    return blocking__advance(s, blocking__clip(sixth * (3.0 * b.k1 + 4.0 * m.k1 - a.k1), 0.0, HUGE_VAL),
                             blocking__clip(sixth * (3.0 * b.k2 + 4.0 * m.k2 - a.k2), 0.0, HUGE_VAL), 0.5 * h);
}

/* Tests whether the rates between t and t + step, known at a, q1, m, q3, b, agree with those at the samples of the
   whole time in this interval. Samples stand at irregular places, so that no periodic change is missed by all of them.
   Differences of less than the tolerance over a gap of samples are accepted. Returns 1, 0, or -1 for a bad rate. */
static inline int blocking__steps_see_all(const blocking_ode_def *def, double t, double step, double span,
                                          const blocking__rates *r, blocking_ode_report *report) {
    const double samples = blocking__samples(def->tolerance), gap = span / samples,
                 first = floor((t - def->start) / gap), last = floor((t + step - def->start) / gap);
    for (double i = first; i <= last && i < samples; i++) {
        double place = i * 0.6180339887498949, x = (def->start + (i + place - floor(place)) * gap - t) / step * 4.0;
        if (!(x > 0.01 && x < 3.99)) continue;
        blocking__rates seen;
        double k1 = 0.0, k2 = 0.0;
        if (!blocking__rates_at(def, t + 0.25 * x * step, &seen, report)) return -1;
        for (int j = 0; j < 5; j++) { /* Lagrange's polynomial through the five */
            double l = 1.0;
            for (int m = 0; m < 5; m++)
                if (m != j) l *= (x - m) / (j - m);
            k1 += l * r[j].k1;
            k2 += l * r[j].k2;
        }
        if (!((fabs(k1 - seen.k1) + fabs(k2 - seen.k2)) * gap <=
              10.0 * def->tolerance + 1e-13 * gap * (seen.k1 + seen.k2)))
            return 0;
    }
    return 1;
}

/* Advances *s from *t to `end`, where nothing jumps between; *h is the step to try, kept from call to call. span: the
   whole time.
   Allowed errors: an error of f decays with the turnover, so a step may add (turnover share + time share)/2 of the
   tolerance and the sum stays below it. */
static inline blocking_status blocking__advance_to(const blocking_ode_def *def, double end, double span, double *t,
                                                   double *h, blocking__state *s, blocking__jumps *jumps,
                                                   blocking_ode_report *report) {
    const double inside = 1e-14 * (fabs(*t) > span ? fabs(*t) : span); /* rates may jump at both ends: they are
                                                                          evaluated inside */
    const int sampled = def->n_breaks == 0 && !(def->max_step < HUGE_VAL);
    blocking__rates a, q1, m, q3, b;
    if (!blocking__rates_at(def, end - *t > 4.0 * inside ? *t + inside : 0.5 * (*t + end), &a, report))
        return BLOCKING_BAD_RATE;
    /* Never the whole interval at once: periodic rates would look constant in steps of whole periods. */
    const double first = 0.27639320225002103 * (end - *t);
    if (*h > first) *h = first;
    while (*t < end) {
        if (report->steps + report->rejected >= def->max_steps) return BLOCKING_TOO_MANY_STEPS;
        double left = end - *t, step = *h < def->max_step ? *h : def->max_step;
        if (sampled && step > jumps->longest_step) step = jumps->longest_step;
        int last = step >= left;
        if (last) step = left;
        if (!blocking__rates_at(def, *t + 0.25 * step, &q1, report) ||
            !blocking__rates_at(def, *t + 0.5 * step, &m, report) ||
            !blocking__rates_at(def, *t + 0.75 * step, &q3, report) ||
            !blocking__rates_at(def, step > 4.0 * inside ? *t + step - inside : *t + 0.5 * step, &b, report))
            return BLOCKING_BAD_RATE;
        blocking__state whole = blocking__magnus(*s, a, m, b, step);
        blocking__state half = blocking__magnus(blocking__magnus(*s, a, q1, m, 0.5 * step), m, q3, b, 0.5 * step);
        double turnover = half.turnover - s->turnover, kept = riddle_exp(-turnover);
        /* 2^4 - 1; the order falls to 1 where f follows the rates at once */
        double order = turnover < 1.0 ? 15.0 : 1.0;
        double error = fabs(half.f - whole.f) / order, error_integral = fabs(half.integral - whole.integral) / order;
        double allowed = 0.5 * def->tolerance * (step / span + (1.0 - kept)),
               allowed_integral = 0.5 * def->tolerance * step;
        if (allowed < 1e-15) allowed = 1e-15; /* round-off, and jumps that are not among the breaks */
        if (allowed_integral < 1e-15 * span) allowed_integral = 1e-15 * span;
        double share =
            error / allowed > error_integral / allowed_integral ? error / allowed : error_integral / allowed_integral;
        double factor = share > 0.0 ? 0.9 / sqrt(sqrt(share)) : 5.0;
        if (share <= 1.0 && sampled && step > 0.02 * span / blocking__samples(def->tolerance)) {
            const blocking__rates five[5] = {a, q1, m, q3, b};
            int seen = blocking__steps_see_all(def, *t, step, span, five, report);
            if (seen < 0) return BLOCKING_BAD_RATE;
            if (!seen) {
                share = 2.0;
                factor = 0.5;
            }
        }
        if (share <= 1.0 || step <= inside) {
            *s = half;
            *t = last ? end : *t + step;
            a = b;
            if (step < 1e-8 * span && !last) {
                double since = *t - jumps->last;
                if (since > 1e-6 * span && since < 4.0 * jumps->longest_step) jumps->longest_step = 0.25 * since;
                jumps->last = *t;
            }
            report->steps++;
            report->error = report->error * kept + error;
            double next = step * blocking__clip(factor, 0.2, 5.0);
            if (!last || next > *h) *h = next; /* a step cut short by `end` says nothing against the longer one */
        } else {
            report->rejected++;
            *h = step * blocking__clip(factor, 0.1, 0.9);
        }
    }
    return BLOCKING_OK;
}

BLOCKING_API blocking_status blocking_integrate(const blocking_ode_def *def, const double *times, size_t n, double *f,
                                                double *mean, blocking_ode_report *report) {
    blocking_ode_report own;
    blocking_ode_report *r = report ? report : &own;
    r->steps = r->rejected = r->evaluations = 0;
    r->error = 0.0;
    r->time = (double)NAN;
    if (n > 0 && (!times || !f)) return BLOCKING_BAD_ARGUMENT;
    for (size_t i = 0; i < n; i++) {
        f[i] = (double)NAN;
        if (mean) mean[i] = (double)NAN;
    }
    if (blocking_check_ode_def(def, NULL) != BLOCKING_OK) return BLOCKING_BAD_DEF;
    if (n == 0) return BLOCKING_TOO_FEW;
    blocking_status status = blocking__check_rising(times, n);
    if (status != BLOCKING_OK) return status;
    double span = times[n - 1] - def->start;
    if (times[0] < def->start || !blocking__finite(span)) return BLOCKING_NOT_RISING;

    blocking__state s;
    s.f = def->f0;
    s.integral = s.turnover = 0.0;
    double t = def->start, h = span;
    blocking__jumps jumps;
    jumps.last = def->start;
    jumps.longest_step = HUGE_VAL;
    size_t next_break = 0;
    for (size_t i = 0; i < n; i++) {
        while (t < times[i]) {
            while (next_break < def->n_breaks && !(def->breaks[next_break] > t)) next_break++;
            double end =
                next_break < def->n_breaks && def->breaks[next_break] < times[i] ? def->breaks[next_break] : times[i];
            status = blocking__advance_to(def, end, span, &t, &h, &s, &jumps, r);
            r->time = t;
            if (status != BLOCKING_OK) return status;
        }
        r->time = t;
        f[i] = s.f;
        if (mean) mean[i] = t > def->start ? blocking__clip(s.integral / (t - def->start), 0.0, 1.0) : s.f;
    }
    return BLOCKING_OK;
}

BLOCKING_API blocking_status blocking_check_schedule(const blocking_schedule *schedule, size_t *row) {
    if (row) *row = 0;
    if (!schedule || !schedule->law) return BLOCKING_BAD_ARGUMENT;
    if (schedule->n == 0) return BLOCKING_TOO_FEW;
    if (!schedule->time || !schedule->K || !schedule->x_h) return BLOCKING_BAD_ARGUMENT;
    for (size_t i = 0; i < schedule->n; i++) {
        if (row) *row = i;
        if (!blocking__finite(schedule->time[i]) || !blocking__finite(schedule->K[i])) return BLOCKING_NOT_FINITE;
        if (i > 0 && !(schedule->time[i] > schedule->time[i - 1])) return BLOCKING_NOT_RISING;
        if (schedule->K[i] < 0.0) return BLOCKING_NEGATIVE;
        blocking_status status = blocking__check_fraction(schedule->x_h[i]);
        if (status != BLOCKING_OK) return status;
    }
    if (row) *row = schedule->n;
    return BLOCKING_OK;
}

BLOCKING_API void blocking_schedule_rates(void *schedule, double t, double *k1, double *k2) {
    const blocking_schedule *s = (const blocking_schedule *)schedule;
    if (!k1 || !k2) return;
    *k1 = *k2 = (double)NAN;
    if (!s || !s->law || !s->time || !s->K || !s->x_h || s->n < 1) return;
    s->law(s->user, blocking__interpolate(s->time, s->K, s->n, t, s->stepwise),
           blocking__interpolate(s->time, s->x_h, s->n, t, s->stepwise), k1, k2);
}

/* ================================================= >>three-point ================================================== */

typedef struct blocking__ratio {
    double rho, log_p;
} blocking__ratio;

/* Returns ln of (f2 - f1)/(f1 - f0) = r (1 - r^(rho - 1))/(1 - r) at r = e^-x, less the measured one; it
   falls with x. */
static inline double blocking__ratio_miss(const void *data, double x) {
    const blocking__ratio *q = (const blocking__ratio *)data;
    double share = x > 0.0 ? riddle_expm1(-(q->rho - 1.0) * x) / riddle_expm1(-x) : q->rho - 1.0;
    return riddle_log(share) - x - q->log_p;
}

BLOCKING_API blocking_status blocking_three_point(const double *t, const double *f, double sigma, double tolerance,
                                                  blocking_estimate *out) {
    if (!out) return BLOCKING_BAD_ARGUMENT;
    const double unknown = (double)NAN;
    out->f_inf = out->f_inf_clipped = out->f0 = out->k = out->k1 = out->k2 = out->r = unknown;
    out->error_f_inf = out->error_f0 = out->error_k = unknown;
    if (!t || !f || !(sigma >= 0.0 && blocking__finite(sigma)) || !(tolerance >= 0.0)) return BLOCKING_BAD_ARGUMENT;
    blocking_status status = blocking__check_readings(t, f, 3);
    if (status != BLOCKING_OK) return status;

    const double first = f[1] - f[0], second = f[2] - f[1], h = t[1] - t[0], rho = (t[2] - t[0]) / h;
    if (!blocking__finite(800.0 / h) || !blocking__finite(rho)) return BLOCKING_NOT_FINITE;
    if (!(fabs(first) > tolerance)) {
        out->f_inf = out->f_inf_clipped = out->f0 = f[0];
        out->error_f_inf = out->error_f0 = sigma;
        return BLOCKING_NO_CHANGE;
    }
    const double p = second / first; /* eq 15 takes the absolute value here, which hides readings that turn back */
    if (!(p > 0.0)) return BLOCKING_NON_MONOTONE;
    if (!(p < rho - 1.0)) return BLOCKING_NOT_SATURATING;

    double x; /* k h */
    if (rho == 2.0) x = -riddle_log(p);
    else if (rho == 3.0) x = -riddle_log(2.0 * p / (1.0 + sqrt(1.0 + 4.0 * p)));
    else {
        blocking__ratio q;
        q.rho = rho;
        q.log_p = riddle_log(p);
        double most = -riddle_log(p / (rho + 1.0));
        if (!(blocking__ratio_miss(&q, 0.0) > 0.0)) return BLOCKING_NOT_SATURATING;
        x = blocking__root(blocking__ratio_miss, &q, 0.0, most);
    }
    out->r = riddle_exp(-x);
    if (!(x > 0.0 && out->r < 1.0 - tolerance)) return BLOCKING_NOT_SATURATING;

    /* u1 = 1 - r, v1 = 1 - r^rho */
    const double u1 = -riddle_expm1(-x), v = riddle_exp(-rho * x), v1 = -riddle_expm1(-rho * x);
    const double A = -first / u1;                                                                /* f(t0) - f_inf */
    out->f_inf = f[0] - A;
    out->f_inf_clipped = blocking__clip(out->f_inf, 0.0, 1.0);
    out->k = x / h;
    out->k1 = blocking_k1(out->f_inf_clipped, out->k);
    out->k2 = blocking_k2(out->f_inf_clipped, out->k);
    const double back = riddle_exp(out->k * t[0]); /* from the first reading to t = 0 */
    out->f0 = t[0] == 0.0 ? f[0] : out->f_inf + A * back;

    /* derivatives of x, A and f_inf by the three readings */
    const double D = rho * v * u1 - out->r * v1;
    const double x1 = v1 / (A * D), x2 = -u1 / (A * D), A1 = -rho * v / D, A2 = out->r / D;
    const double dx[3] = {-(x1 + x2), x1, x2}, dA[3] = {-(A1 + A2), A1, A2}, df[3] = {1.0 + A1 + A2, -A1, -A2};
    double inf2 = 0.0, k2 = 0.0, f02 = 0.0;
    for (int i = 0; i < 3; i++) {
        inf2 += df[i] * df[i];
        k2 += dx[i] * dx[i];
        f02 += blocking__square(df[i] + back * dA[i] + A * back * t[0] / h * dx[i]);
    }
    out->error_f_inf = sigma * sqrt(inf2);
    out->error_k = sigma * sqrt(k2) / h;
    out->error_f0 = sigma * sqrt(f02);
    if (!blocking__finite(out->f0)) out->f0 = out->error_f0 = unknown;
    return blocking__within(out->f_inf, 0.0, 1.0) && blocking__within(out->f0, 0.0, 1.0) ? BLOCKING_OK
                                                                                         : BLOCKING_OUT_OF_RANGE;
}

/* =================================================== >>student ==================================================== */

/* Returns P(|Z| < z) for a normal Z by the series of erf, whose terms are all positive. */
static inline double blocking__normal_share(double z) {
    double term = z, sum = z;
    for (int n = 1; n < 200 && term > 1e-18 * sum; n++) {
        term *= z * z / (2 * n + 1);
        sum += term;
    }
    return sqrt(2.0 / RIDDLE_PI) * riddle_exp(-0.5 * z * z) * sum;
}

BLOCKING_API double blocking_student(double z, double dof) {
    if (!(z > 0.0 && dof >= 1.0)) return (double)NAN;
    if (z > 7.0) z = 7.0;
    return dof >= 1e6 ? z : riddle_student(blocking__normal_share(z), floor(dof));
}

/* ===================================================== >>fit ====================================================== */

BLOCKING_API blocking_fit_def blocking_default_fit_def(void) {
    blocking_fit_def def;
    def.k_low = 1e-9;
    def.k_high = 1e6;
    def.z = 1.96;
    def.turn_back = 0.5;
    def.tolerance = BLOCKING_TOLERANCE;
    def.cookie = BLOCKING__COOKIE_FIT;
    return def;
}

BLOCKING_API blocking_status blocking_check_fit_def(const blocking_fit_def *def, const char **field) {
    const char *bad = NULL;
    if (!def) bad = "def";
    else if (def->cookie != BLOCKING__COOKIE_FIT) bad = "cookie";
    else if (!(def->k_low > 0.0)) bad = "k_low";
    else if (!(def->k_high > def->k_low && blocking__finite(def->k_high))) bad = "k_high";
    else if (!(def->z > 0.0 && blocking__finite(def->z))) bad = "z";
    else if (!(def->turn_back > 0.0)) bad = "turn_back";
    else if (!(def->tolerance >= 0.0)) bad = "tolerance";
    if (field) *field = bad;
    return bad ? BLOCKING_BAD_DEF : BLOCKING_OK;
}

typedef struct blocking__data {
    const double *t, *f, *sigma;
    size_t n;
    double f_mean, origin; /* origin: the time of f0 [s] */
} blocking__data;

/* The best curve for one k. */
typedef struct blocking__trial {
    double k, f0, f_inf, sse, slope; /* slope: half of d sse / d ln k */
} blocking__trial;

static inline double blocking__weight(const blocking__data *d, size_t i) {
    return d->sigma ? 1.0 / (d->sigma[i] * d->sigma[i]) : 1.0;
}

/* Returns 1 - e^-x and sets *e to e^-x, at the price of one transcendental function. */
static inline double blocking__gone(double x, double *e) {
    double u = x < 0.35 ? -riddle_expm1(-x) : 0.0;
    *e = x < 0.35 ? 1.0 - u : riddle_exp(-x);
    return x < 0.35 ? u : 1.0 - *e;
}

static inline void blocking__residuals(const blocking__data *d, blocking__trial *trial) {
    trial->sse = trial->slope = 0.0;
    for (size_t i = 0; i < d->n; i++) {
        double x = trial->k * (d->t[i] - d->origin), e, u = blocking__gone(x, &e), w = blocking__weight(d, i);
        double change = trial->f_inf - trial->f0, miss = d->f[i] - trial->f0 - change * u;
        trial->sse += w * miss * miss;
        trial->slope -= w * miss * change * (x < 800.0 ? x * e : 0.0);
    }
}

/* Finds the best f0 and f_inf for a fixed k. f = f0 + (f_inf - f0) u with u = 1 - e^(-k t) is a straight line: a
   regression, then, if it leaves the box 0..1, the best of the edges of the box. */
static inline blocking__trial blocking__try(const blocking__data *d, double log_k) {
    blocking__trial best;
    best.k = riddle_exp(log_k);
    const double centre = -riddle_expm1(-best.k * (d->t[d->n / 2] - d->origin));
    double sw = 0.0, su = 0.0, suu = 0.0, suf = 0.0, uu = 0.0, uf = 0.0, ee = 0.0, ef = 0.0, eu = 0.0;
    for (size_t i = 0; i < d->n; i++) {
        double e, u = blocking__gone(best.k * (d->t[i] - d->origin), &e), w = blocking__weight(d, i),
                  f = d->f[i] - d->f_mean;
        sw += w;
        su += w * (u - centre);
        suu += w * (u - centre) * (u - centre);
        suf += w * (u - centre) * f;
        uu += w * u * u;
        uf += w * u * d->f[i];
        ee += w * e * e;
        ef += w * e * d->f[i];
        eu += w * e * u;
    }
    const double mean = su / sw, spread = suu - su * mean, slope = spread > 0.0 ? suf / spread : 0.0;
    best.f0 = d->f_mean - slope * (centre + mean);
    best.f_inf = best.f0 + slope;
    if (blocking__within(best.f0, 0.0, 1.0) && blocking__within(best.f_inf, 0.0, 1.0)) {
        blocking__residuals(d, &best);
        return best;
    }
    best.sse = HUGE_VAL;
    for (int edge = 0; edge < 4; edge++) {
        blocking__trial trial = best;
        const double c = edge & 1 ? 1.0 : 0.0;
        trial.f0 = edge & 2 ? c : blocking__clip(ee > 0.0 ? (ef - c * eu) / ee : d->f[0], 0.0, 1.0);
        trial.f_inf = edge & 2 ? blocking__clip(uu > 0.0 ? (uf - c * eu) / uu : d->f[d->n - 1], 0.0, 1.0) : c;
        blocking__residuals(d, &trial);
        if (trial.sse < best.sse) best = trial;
    }
    return best;
}

static inline double blocking__slope_at(const void *data, double log_k) {
    return blocking__try((const blocking__data *)data, log_k).slope;
}
/* Returns the place of the minimum near `at`, which is lower than its neighbours at +- step: where the slope changes
   from falling to rising. */
static inline double blocking__refine(const blocking__data *d, double at, double step) {
    double here = blocking__slope_at(d, at);
    if (here == 0.0) return at;
    double low = here < 0.0 ? at : at - step, high = here < 0.0 ? at + step : at;
    for (int i = 0; i < 60; i++) {
        double slope_low = blocking__slope_at(d, low), slope_high = blocking__slope_at(d, high);
        if (slope_low < 0.0 && slope_high > 0.0) return blocking__root(blocking__slope_at, d, low, high);
        double middle = 0.5 * (low + high);
        if (blocking__slope_at(d, middle) < 0.0) low = middle;
        else high = middle;
    }
    return 0.5 * (low + high);
}

/* Computes standard errors from the inverse of the normal matrix of (f0, f_inf, ln k). A value on a bound has no error;
   the errors of the others then hold for this value fixed. */
static inline void blocking__fit_errors(const blocking__data *d, blocking_fit_result *out, double variance) {
    double m[3][3] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    for (size_t i = 0; i < d->n; i++) {
        double x = out->k * d->t[i], e, u = blocking__gone(x, &e), w = blocking__weight(d, i);
        double j[3] = {e, u, (out->f_inf - out->f0) * (x < 800.0 ? x * e : 0.0)};
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) m[a][b] += w * j[a] * j[b];
    }
    const int bound[3] = {out->f0_on_bound, out->f_inf_on_bound, 0};
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            if (bound[a] || bound[b]) m[a][b] = a == b ? 1.0 : 0.0;
    double error[3], determinant = 0.0, minor[3];
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        minor[a] = m[b][b] * m[c][c] - m[b][c] * m[c][b];
    }
    determinant = m[0][0] * minor[0] - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                  m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    for (int a = 0; a < 3; a++)
        error[a] =
            !bound[a] && determinant > 0.0 && minor[a] >= 0.0 ? sqrt(variance * minor[a] / determinant) : (double)NAN;
    out->error_f0 = error[0];
    out->error_f_inf = error[1];
    out->error_k = error[2] * out->k;
}

/* Returns whether readings run against the curve by more than the allowed share of the range and more
   than the noise. */
static inline int blocking__turns_back(const blocking_fit_def *def, const blocking__data *d, double direction,
                                       double range) {
    size_t extreme = 0;
    for (size_t i = 1; i < d->n; i++) {
        double back = direction * (d->f[extreme] - d->f[i]);
        if (back <= 0.0) extreme = i;
        else if (back > def->turn_back * range) {
            double noise =
                d->sigma ? def->z * sqrt(d->sigma[extreme] * d->sigma[extreme] + d->sigma[i] * d->sigma[i]) : 0.0;
            if (back > noise) return 1;
        }
    }
    return 0;
}

/* Returns the sum of squares of the straight line through the readings, the limit of curves with ever smaller k and
   ever more distant f_inf. If no curve within 0..1 is better, the readings do not level off. */
static inline double blocking__straight_line(const blocking__data *d) {
    double sw = 0.0, st = 0.0, stt = 0.0, stf = 0.0, sse = 0.0, middle = d->t[d->n / 2];
    for (size_t i = 0; i < d->n; i++) {
        double w = blocking__weight(d, i), x = d->t[i] - middle;
        sw += w;
        st += w * x;
        stt += w * x * x;
        stf += w * x * (d->f[i] - d->f_mean);
    }
    double slope = stf / (stt - st * st / sw);
    for (size_t i = 0; i < d->n; i++)
        sse += blocking__weight(d, i) * blocking__square(d->f[i] - d->f_mean - slope * (d->t[i] - middle - st / sw));
    return sse;
}

/* >>ranges
   The ranges are those of the fit without bounds, cut to what is possible: there sums of squares follow the F
   distribution, which they don't where a bound is met, and a cut takes no true value away. So the curve is alpha + beta
   u(t) with any alpha and beta, and k may be negative: u runs from 0 at the first time to 1 at the last, straight for
   k = 0. Whatever a range is asked of (f0, f_inf, f at a time, its mean) is linear in alpha and beta; for one k all
   values within the target form an interval, and the range is the hull over all k. */
typedef struct blocking__line {
    double alpha, beta, sse;
    double v_alpha, v_beta, v_cross; /* inverse of the normal matrix */
} blocking__line;

/* Returns u at the share x of the time between first and last reading, for kappa = k times that time. */
static inline double blocking__shape(double kappa, double x) {
    if (kappa < 0.0) return 1.0 - blocking__shape(-kappa, 1.0 - x);
    return kappa > 1e-12 ? riddle_expm1(-kappa * x) / riddle_expm1(-kappa) : x;
}

static inline blocking__line blocking__regress(const blocking__data *d, double kappa) {
    const double first = d->t[0], span = d->t[d->n - 1] - first,
                 centre = blocking__shape(kappa, (d->t[d->n / 2] - first) / span);
    double sw = 0.0, su = 0.0, suu = 0.0, suf = 0.0;
    blocking__line line;
    for (size_t i = 0; i < d->n; i++) {
        double w = blocking__weight(d, i), u = blocking__shape(kappa, (d->t[i] - first) / span) - centre;
        sw += w;
        su += w * u;
        suu += w * u * u;
        suf += w * u * (d->f[i] - d->f_mean);
    }
    const double mean = su / sw, spread = suu - su * mean; /* f_mean is the weighted mean: no second sum of f */
    line.beta = spread > 0.0 ? suf / spread : 0.0;
    line.alpha = d->f_mean - line.beta * (centre + mean);
    line.v_beta = spread > 0.0 ? 1.0 / spread : HUGE_VAL;
    line.v_alpha = 1.0 / sw + (centre + mean) * (centre + mean) * line.v_beta;
    line.v_cross = -(centre + mean) * line.v_beta;
    line.sse = 0.0;
    for (size_t i = 0; i < d->n; i++) {
        double u = blocking__shape(kappa, (d->t[i] - first) / span);
        line.sse += blocking__weight(d, i) * blocking__square(d->f[i] - line.alpha - line.beta * u);
    }
    return line;
}

/* Returns kappa of a place x on the scale from accelerating curves (x < 0) to saturating ones; sinh makes it
   logarithmic at both ends. */
static inline double blocking__kappa(double x) { return 0.5 * (riddle_exp(x) - riddle_exp(-x)); }

enum { BLOCKING__SCAN = 120 };

typedef struct blocking__region {
    double end;    /* places from -end to end are searched */
    double least;  /* smallest sum of squares */
    double target; /* largest sum of squares that is accepted */
    double place;  /* where the least is, unless the fit's own is less */
    double student, variance;
    double from, to; /* places of the range of k */
} blocking__region;

/* Finds the place of the least sum of squares between two by golden section. */
static inline double blocking__least_place(const blocking__data *d, double low, double high) {
    const double golden = 0.38196601125010515;
    double a = low + golden * (high - low), b = high - golden * (high - low);
    double sse_a = blocking__regress(d, blocking__kappa(a)).sse, sse_b = blocking__regress(d, blocking__kappa(b)).sse;
    for (int i = 0; i < 32; i++) {
        if (sse_a < sse_b) {
            high = b, b = a, sse_b = sse_a;
            a = low + golden * (high - low);
            sse_a = blocking__regress(d, blocking__kappa(a)).sse;
        } else {
            low = a, a = b, sse_a = sse_b;
            b = high - golden * (high - low);
            sse_b = blocking__regress(d, blocking__kappa(b)).sse;
        }
    }
    return 0.5 * (low + high);
}

static inline blocking__region blocking__region_of(const blocking__data *d, const blocking_fit_def *def, double k_high,
                                                   double best) {
    blocking__region r;
    const double span = d->t[d->n - 1] - d->t[0], most = 2.0 * k_high * span;
    r.end = riddle_log(most < 1e150 ? most : 1e150);
    r.least = best;
    r.from = r.to = r.place = 0.0;
    const double step = 2.0 * r.end / (double)BLOCKING__SCAN;
    double before = HUGE_VAL, here = HUGE_VAL;
    for (int i = 0; i <= BLOCKING__SCAN + 1; i++) { /* every minimum of the scan is refined */
        double after = i <= BLOCKING__SCAN ? blocking__regress(d, blocking__kappa(i * step - r.end)).sse : HUGE_VAL;
        if (here <= before && here <= after && here < HUGE_VAL) {
            double place = blocking__least_place(d, (i - 2) * step - r.end, i * step - r.end);
            double refined = blocking__regress(d, blocking__kappa(place)).sse;
            if (here < r.least) r.least = here, r.place = (i - 1) * step - r.end;
            if (refined < r.least) r.least = refined, r.place = place;
        }
        before = here;
        here = after;
    }
    const double dof = d->sigma ? HUGE_VAL : (double)d->n - 3.0;
    r.student = dof >= 1.0 ? blocking_student(def->z, dof) : HUGE_VAL;
    r.variance = d->sigma ? 1.0 : dof >= 1.0 ? r.least / dof : HUGE_VAL;
    r.target = r.student < HUGE_VAL ? r.least + r.student * r.student * r.variance : HUGE_VAL;
    /* Where a constant is within the target, any k fits, and the best one follows the noise more than one parameter
       does: without the factors, found by trials, ranges of readings that do not change hold 90 to 93 of 100 */
    double constant = 0.0;
    for (size_t i = 0; i < d->n; i++) constant += blocking__weight(d, i) * blocking__square(d->f[i] - d->f_mean);
    if (constant <= r.target && r.target < HUGE_VAL)
        r.target = r.least + (d->sigma ? 1.6 : 1.3) * r.student * r.student * r.variance;
    return r;
}

/* Finds by bisection the place between one inside the target and one outside at which the target is met. */
static inline double blocking__meet(const blocking__data *d, double target, double inside, double outside) {
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (inside + outside);
        if (blocking__regress(d, blocking__kappa(middle)).sse <= target) inside = middle;
        else outside = middle;
    }
    return inside;
}

/* Finds the range of k: from 0 where straight lines are within the target, to infinity where steps are. */
static inline void blocking__range_k(const blocking__data *d, blocking__region *r, double k, double *low,
                                     double *high) {
    const double span = d->t[d->n - 1] - d->t[0], step = r->end / (double)BLOCKING__SCAN, x = k * span;
    const double at = riddle_log(x + sqrt(x * x + 1.0));
    double first = at, last = at; /* outermost places found within the target, and the places of the scan beyond them */
    double ahead = step * floor(at / step), beyond = ahead + step;
    /* the fit's k may be far from it */
    if (r->place > 0.0 && blocking__regress(d, blocking__kappa(r->place)).sse <= r->target) {
        if (r->place < first) first = r->place, ahead = step * floor(r->place / step);
        if (r->place > last) last = r->place, beyond = step * (floor(r->place / step) + 1.0);
    }
    for (int i = 0; i <= BLOCKING__SCAN; i++) {
        if (!(blocking__regress(d, blocking__kappa(i * step)).sse <= r->target)) continue;
        if (i * step < first) first = i * step, ahead = (i - 1) * step;
        if (i * step > last) last = i * step, beyond = (i + 1) * step;
    }
    r->from = first > 0.0 ? blocking__meet(d, r->target, first, ahead) : 0.0;
    r->to = last < r->end ? blocking__meet(d, r->target, last, beyond) : r->end;
    *low = r->from > 0.0 ? blocking__kappa(r->from) / span : 0.0;
    *high = r->to < r->end ? blocking__kappa(r->to) / span : HUGE_VAL;
    if (*low > k) *low = k; /* rounding */
    if (*high < k) *high = k;
}

/* Quantity of a range: f at T, or its mean over 0..T. */
typedef struct blocking__wish {
    double T; /* [s] since t = 0; infinite: f_inf */
    int mean; /* of f over 0..T */
} blocking__wish;

/* Returns e^x times a share, at most 1e130: no range of f reaches as far. The share may be too small for the
   product of the two. */
static inline double blocking__grown(double x, double share) {
    if (x < 300.0) return riddle_exp(x) * share;
    const double power = x + riddle_log(share);
    return riddle_exp(power < 300.0 ? power : 300.0);
}

/* Returns the share of the change from `first` on that a wish sees: f = f(first) + (f_inf - f(first)) share. It is
   negative before. */
static inline double blocking__seen(blocking__wish wish, double k, double first) {
    if (!(wish.T < HUGE_VAL)) return 1.0;
    if (!wish.mean) return -riddle_expm1(k * (first - wish.T) < 300.0 ? k * (first - wish.T) : 300.0);
    const double x = k * wish.T;
    return 1.0 - blocking__grown(k * first, x < 0.5 ? 1.0 - blocking__mean_share(x) : -riddle_expm1(-x) / x);
}

/* Extends *low and *high by the values within the target at one place. */
static inline void blocking__join(const blocking__data *d, const blocking__region *r, blocking__wish wish, double place,
                                  double *low, double *high) {
    const double kappa = blocking__kappa(place), first = d->t[0], span = d->t[d->n - 1] - first, k = kappa / span;
    blocking__line line = blocking__regress(d, kappa);
    if (!(kappa > 0.0 && line.sse <= r->target)) return;
    /* f = alpha + beta (1 - e^(-k (t - first)))/(1 - e^(-kappa)) */
    const double b = blocking__seen(wish, k, first) / -riddle_expm1(-kappa), value = line.alpha + b * line.beta;
    const double v = line.v_alpha + 2.0 * b * line.v_cross + b * b * line.v_beta;
    const double reach = !(v < HUGE_VAL)                   ? HUGE_VAL
                         : r->target > line.sse && v > 0.0 ? sqrt(v * (r->target - line.sse))
                                                           : 0.0;
    if (!(fabs(value) < HUGE_VAL)) return;
    if (value - reach < *low) *low = value - reach;
    if (value + reach > *high) *high = value + reach;
}

/* Finds the hull of the values over all places, cut at 0 and 1. best: the fitted value, which always belongs to it.
   Values that all lie beyond, as those long before the first reading may, say nothing. Close to straight lines f_inf
   runs off: the first place is near one. */
static inline void blocking__range(const blocking__data *d, const blocking__region *r, blocking__wish wish, double best,
                                   double *low, double *high) {
    const double near = wish.T < HUGE_VAL || r->from > 0.0 ? 0.01 : 1e-9;
    *low = *high = best;
    for (int i = 0; i <= BLOCKING__SCAN; i++)
        blocking__join(d, r, wish, r->from + (r->to - r->from) * (i > 0 ? i : near) / (double)BLOCKING__SCAN, low,
                       high);
    const int none = *low > 1.0 || *high < 0.0;
    *low = none ? 0.0 : blocking__clip(*low, 0.0, 1.0);
    *high = none ? 1.0 : blocking__clip(*high, 0.0, 1.0);
}

static inline void blocking__clear_fit(blocking_fit_result *out) {
    const double unknown = (double)NAN;
    out->f0 = out->f_inf = out->k = out->k1 = out->k2 = out->sse = out->r2 = out->dof = out->student = unknown;
    out->error_f0 = out->error_f_inf = out->error_k = out->k_lowest = out->k_highest = unknown;
    out->f0_lowest = out->f0_highest = out->f_inf_lowest = out->f_inf_highest = unknown;
    out->k_determined = out->f_inf_determined = out->f0_on_bound = out->f_inf_on_bound = 0;
}

static inline blocking_status blocking__check_sigma(const double *sigma, size_t n) {
    for (size_t i = 0; sigma && i < n; i++) {
        if (!blocking__finite(sigma[i])) return BLOCKING_NOT_FINITE;
        if (!(sigma[i] > 0.0 && blocking__finite(1.0 / (sigma[i] * sigma[i]))))
            return sigma[i] < 0.0 ? BLOCKING_NEGATIVE : BLOCKING_BAD_ARGUMENT;
    }
    return BLOCKING_OK;
}

typedef struct blocking__search {
    blocking__data d;
    double range, sst, low, high; /* of the readings; bounds of ln k */
} blocking__search;

/* Checks the readings and bounds the search; with NO_CHANGE everything is set as well. f0 is that of t = 0, or of the
   first reading. */
static inline blocking_status blocking__pose(const blocking_fit_def *def, const double *t, const double *f,
                                             const double *sigma, size_t n, int from_first, blocking__search *s) {
    s->d.f_mean = s->sst = s->range = 0.0;
    if (blocking_check_fit_def(def, NULL) != BLOCKING_OK) return BLOCKING_BAD_DEF;
    if (n > 0 && (!t || !f)) return BLOCKING_BAD_ARGUMENT;
    if (n < 3) return BLOCKING_TOO_FEW;
    blocking_status status = blocking__check_readings(t, f, n);
    if (status == BLOCKING_OK) status = blocking__check_sigma(sigma, n);
    if (status != BLOCKING_OK) return status;
    s->d.t = t;
    s->d.f = f;
    s->d.sigma = sigma;
    s->d.n = n;
    s->d.origin = from_first ? t[0] : 0.0;
    double lowest = f[0], highest = f[0], gap = t[1] - t[0], weight = 0.0;
    for (size_t i = 0; i < n; i++) {
        double w = blocking__weight(&s->d, i);
        weight += w;
        s->d.f_mean += w * (f[i] - f[0]);
        if (f[i] < lowest) lowest = f[i];
        if (f[i] > highest) highest = f[i];
        if (i > 0 && t[i] - t[i - 1] < gap) gap = t[i] - t[i - 1];
    }
    s->d.f_mean = f[0] + s->d.f_mean / weight;
    s->range = highest - lowest;
    for (size_t i = 0; i < n; i++) s->sst += blocking__weight(&s->d, i) * blocking__square(f[i] - s->d.f_mean);
    const double slowest = 1e-4 / (t[n - 1] - s->d.origin), k_low = def->k_low > slowest ? def->k_low : slowest;
    const double k_high = def->k_high < 40.0 / gap ? def->k_high : 40.0 / gap;
    if (!(k_low > 0.0 && k_low < k_high && blocking__finite(k_high) && blocking__finite(weight)))
        return BLOCKING_BAD_DEF;
    s->low = riddle_log(k_low);
    s->high = riddle_log(k_high);
    return s->range > def->tolerance ? BLOCKING_OK : BLOCKING_NO_CHANGE;
}

/* Returns the best of all minima on a grid in ln k. *end: -1 or 1 if it lies at an end of the search, otherwise 0. */
static inline blocking__trial blocking__search_k(const blocking__search *s, int *end) {
    const int cells = 2 + (int)((s->high - s->low) / 0.25);
    const double step = (s->high - s->low) / cells;
    blocking__trial best = blocking__try(&s->d, s->low), before = best, here = best;
    *end = -1;
    for (int i = 0; i < cells; i++) {
        blocking__trial after = blocking__try(&s->d, s->low + (i + 1) * step);
        if (i > 0 && here.sse <= before.sse && here.sse < after.sse) {
            blocking__trial refined = blocking__try(&s->d, blocking__refine(&s->d, s->low + i * step, step));
            if (here.sse < refined.sse) refined = here;
            if (refined.sse < best.sse) {
                best = refined;
                *end = 0;
            }
        }
        if (i == cells - 1 && after.sse < best.sse) {
            best = after;
            *end = 1;
        }
        before = here;
        here = after;
    }
    return best;
}

static inline void blocking__fill_ranges(const blocking__search *s, const blocking_fit_def *def,
                                         blocking_fit_result *out) {
    blocking__region r = blocking__region_of(&s->d, def, riddle_exp(s->high), out->sse);
    const blocking__wish at_start = {0.0, 0}, at_end = {HUGE_VAL, 0};
    out->dof = s->d.sigma ? HUGE_VAL : (double)s->d.n - 3.0;
    out->student = r.student;
    if (!(r.target < HUGE_VAL)) return; /* as many readings as unknowns: nothing is known of the spread */
    blocking__fit_errors(&s->d, out, r.variance);
    blocking__range_k(&s->d, &r, out->k > 0.0 ? out->k : 0.0, &out->k_lowest, &out->k_highest); /* no k: NO_CHANGE */
    blocking__range(&s->d, &r, at_start, out->f0, &out->f0_lowest, &out->f0_highest);
    blocking__range(&s->d, &r, at_end, out->f_inf, &out->f_inf_lowest, &out->f_inf_highest);
    out->k_determined = out->k_lowest > 0.0 && out->k_highest < HUGE_VAL;
    out->f_inf_determined = out->f_inf_highest - out->f_inf_lowest < 0.5;
}

BLOCKING_API blocking_status blocking_fit(const blocking_fit_def *def, const double *t, const double *f,
                                          const double *sigma, size_t n, blocking_fit_result *out) {
    if (!out) return BLOCKING_BAD_ARGUMENT;
    blocking__search s;
    blocking__clear_fit(out);
    blocking_status status = blocking__pose(def, t, f, sigma, n, 0, &s);
    if (status == BLOCKING_NO_CHANGE) {
        out->f0 = out->f_inf = s.d.f_mean;
        out->sse = s.sst;
        if (s.sst > 0.0) out->r2 = 0.0;
        if (sigma) blocking__fill_ranges(&s, def, out); /* without, equal readings do not tell their spread */
    }
    if (status != BLOCKING_OK) return status;
    int end;
    const blocking__trial best = blocking__search_k(&s, &end);
    out->f0 = best.f0;
    out->f_inf = best.f_inf;
    out->k = best.k;
    out->k1 = blocking_k1(best.f_inf, best.k);
    out->k2 = blocking_k2(best.f_inf, best.k);
    out->sse = best.sse;
    if (s.sst > 0.0) out->r2 = 1.0 - best.sse / s.sst;
    out->f0_on_bound = best.f0 <= 0.0 || best.f0 >= 1.0;
    out->f_inf_on_bound = best.f_inf <= 0.0 || best.f_inf >= 1.0;
    blocking__fill_ranges(&s, def, out);
    if (blocking__turns_back(def, &s.d, best.f_inf < best.f0 ? -1.0 : 1.0, s.range)) return BLOCKING_NON_MONOTONE;
    if (end > 0 || best.k * (t[1] - t[0]) > 15.0) return BLOCKING_NOT_RESOLVED;
    if (end < 0 || blocking__straight_line(&s.d) <= best.sse) return BLOCKING_NOT_SATURATING;
    return BLOCKING_OK;
}

BLOCKING_API blocking_status blocking_fit_holes(const blocking_fit_def *def, const double *t, const size_t *free_holes,
                                                const size_t *holes, size_t n, double *f, double *sigma,
                                                blocking_fit_result *out) {
    blocking_status status = BLOCKING_OK;
    double free_all = 0.0, all = 0.0;
    if (out) blocking__clear_fit(out);
    if (!out || (n > 0 && !(t && free_holes && holes && f && sigma))) return BLOCKING_BAD_ARGUMENT;
    for (size_t i = 0; i < n; i++) {
        if (!(holes[i] > 0 && free_holes[i] <= holes[i])) return BLOCKING_BAD_COUNT;
        f[i] = (double)free_holes[i] / (double)holes[i];
        free_all += (double)free_holes[i], all += (double)holes[i];
    }
    for (int round = 0; round < 5; round++) { /* the first: one error for all */
        for (size_t i = 0; i < n; i++) {
            const double m = (double)holes[i],
                         curve = round == 0     ? free_all / all
                                 : out->k > 0.0 ? blocking_curve(out->f0, out->f_inf, out->k, t[i])
                                                : out->f_inf,
                         p = (curve * m + 1.0) / (m + 2.0);
            sigma[i] = sqrt(p * (1.0 - p) / m);
        }
        status = blocking_fit(def, t, f, sigma, n, out);
        if (status > BLOCKING_NOT_RESOLVED) return status;
    }
    return status;
}

BLOCKING_API blocking_status blocking_fit_range(const blocking_fit_def *def, const double *t, const double *f,
                                                const double *sigma, size_t n, double T, double *f_lowest,
                                                double *f_highest, double *mean_lowest, double *mean_highest) {
    double low[2] = {(double)NAN, (double)NAN}, high[2] = {(double)NAN, (double)NAN};
    blocking__search s;
    blocking_status status = T >= 0.0 ? blocking__pose(def, t, f, sigma, n, 1, &s) : BLOCKING_BAD_ARGUMENT;
    if (f_lowest) *f_lowest = low[0];
    if (f_highest) *f_highest = high[0];
    if (mean_lowest) *mean_lowest = low[1];
    if (mean_highest) *mean_highest = high[1];
    if (status == BLOCKING_NO_CHANGE && sigma) status = BLOCKING_OK; /* sigma tells how accurately equal readings are
                                                                        known */
    if (status != BLOCKING_OK) return status;
    int end;
    const blocking__trial best = blocking__search_k(&s, &end);
    blocking__region r = blocking__region_of(&s.d, def, riddle_exp(s.high), best.sse);
    double k_low, k_high;
    if (!(r.target < HUGE_VAL)) return BLOCKING_TOO_FEW;
    blocking__range_k(&s.d, &r, best.k, &k_low, &k_high);
    for (int mean = 0; mean < 2; mean++) {
        blocking__wish wish;
        wish.T = T;
        wish.mean = mean;
        double value = best.f0 + (best.f_inf - best.f0) * blocking__seen(wish, best.k, s.d.origin);
        blocking__range(&s.d, &r, wish, value, &low[mean], &high[mean]);
    }
    if (f_lowest) *f_lowest = low[0];
    if (f_highest) *f_highest = high[0];
    if (mean_lowest) *mean_lowest = low[1];
    if (mean_highest) *mean_highest = high[1];
    return BLOCKING_OK;
}

/* ===================================================== >>law ====================================================== */

enum { BLOCKING__MOST = 2 * BLOCKING_LAW_TERMS };

/* Tests with covariates shifted and scaled to about -1..1: (x - centre)/width. */
typedef struct blocking__tests {
    const blocking_test *test;
    size_t n, readings;
    double centre[3], width[3]; /* width 0: the same in all tests, or without influence */
} blocking__tests;

typedef struct blocking__law_trial {
    int used_a, used_b, terms; /* terms in all */
    double x[BLOCKING__MOST];  /* a then b, in scaled covariates; unused ones 0 */
    double sse;
    double gradient[BLOCKING__MOST], normal[BLOCKING__MOST][BLOCKING__MOST]; /* of sse/2 */
} blocking__law_trial;

static inline double blocking__covariate(const blocking_test *test, int j) {
    return j == 0 ? test->K : j == 1 ? test->x_h : test->moisture;
}

static inline double blocking__term(const blocking__tests *all, const blocking_test *test, int j) {
    return j == 0                    ? 1.0
           : all->width[j - 1] > 0.0 ? (blocking__covariate(test, j - 1) - all->centre[j - 1]) / all->width[j - 1]
                                     : 0.0;
}

static inline double blocking__test_weight(const blocking_test *test, size_t i) {
    return test->sigma ? 1.0 / (test->sigma[i] * test->sigma[i]) : 1.0;
}

/* Returns the f0 of a test that suits k1 and k2 best; *f_inf: theirs. */
static inline double blocking__best_f0(const blocking_test *test, double k1, double k2, double *f_inf) {
    double ee = 0.0, ef = 0.0;
    *f_inf = k2 / (k1 + k2);
    for (size_t i = 0; i < test->n; i++) {
        double e, u = blocking__gone((k1 + k2) * test->t[i], &e), w = blocking__test_weight(test, i);
        ee += w * e * e;
        ef += w * e * (test->f[i] - *f_inf * u);
    }
    return ee > 0.0 ? blocking__clip(ef / ee, 0.0, 1.0) : test->f[0];
}

/* Computes sum of squares, gradient and normal matrix; each f0 follows from the rates (variable projection). */
static inline void blocking__law_sums(const blocking__tests *all, blocking__law_trial *trial) {
    const double h = 1e-6;
    trial->sse = 0.0;
    for (int i = 0; i < BLOCKING__MOST; i++) {
        trial->gradient[i] = 0.0;
        for (int j = 0; j < BLOCKING__MOST; j++) trial->normal[i][j] = 0.0;
    }
    for (size_t s = 0; s < all->n; s++) {
        const blocking_test *test = &all->test[s];
        double log_k[2] = {0.0, 0.0}, z[BLOCKING_LAW_TERMS], k1[3], k2[3], f0[3], f_inf[3];
        for (int j = 0; j < BLOCKING_LAW_TERMS; j++) {
            z[j] = blocking__term(all, test, j);
            log_k[0] += trial->x[j] * z[j];
            log_k[1] += trial->x[BLOCKING_LAW_TERMS + j] * z[j];
        }
        for (int m = 0; m < 3; m++) {
            k1[m] = riddle_exp(blocking__clip(log_k[0] + (m == 1 ? h : 0.0), -80.0, 80.0));
            k2[m] = riddle_exp(blocking__clip(log_k[1] + (m == 2 ? h : 0.0), -80.0, 80.0));
            f0[m] = blocking__best_f0(test, k1[m], k2[m], &f_inf[m]);
        }
        for (size_t i = 0; i < test->n; i++) {
            double w = blocking__test_weight(test, i), f[3], slope[BLOCKING__MOST];
            for (int m = 0; m < 3; m++) f[m] = blocking_curve(f0[m], f_inf[m], k1[m] + k2[m], test->t[i]);
            for (int j = 0; j < BLOCKING__MOST; j++) {
                int second = j >= BLOCKING_LAW_TERMS, term = j % BLOCKING_LAW_TERMS;
                int on = (second ? trial->used_b : trial->used_a) >> term & 1;
                slope[j] = on ? (f[1 + second] - f[0]) / h * z[term] : 0.0;
            }
            double miss = f[0] - test->f[i];
            trial->sse += w * miss * miss;
            for (int a = 0; a < BLOCKING__MOST; a++) {
                trial->gradient[a] += w * miss * slope[a];
                for (int b = 0; b < BLOCKING__MOST; b++) trial->normal[a][b] += w * slope[a] * slope[b];
            }
        }
    }
}

/* Computes x = (A + damping diag A)^-1 x for the used terms. Returns 0 if A is not positive definite. */
static inline int blocking__law_solve(const blocking__law_trial *trial, double damping, double *x) {
    double l[BLOCKING__MOST][BLOCKING__MOST];
    for (int i = 0; i < BLOCKING__MOST; i++) {
        int on = (i < BLOCKING_LAW_TERMS ? trial->used_a >> i : trial->used_b >> (i - BLOCKING_LAW_TERMS)) & 1;
        for (int j = 0; j <= i; j++) {
            double sum = i != j ? trial->normal[i][j] : on ? trial->normal[i][i] * (1.0 + damping) : 1.0;
            for (int k = 0; k < j; k++) sum -= l[i][k] * l[j][k];
            if (i == j && !(sum > 1e-12 * trial->normal[i][i])) return 0;
            l[i][j] = i == j ? sqrt(sum) : sum / l[j][j];
        }
    }
    for (int i = 0; i < BLOCKING__MOST; i++) {
        for (int k = 0; k < i; k++) x[i] -= l[i][k] * x[k];
        x[i] /= l[i][i];
    }
    for (int i = BLOCKING__MOST - 1; i >= 0; i--) {
        for (int k = i + 1; k < BLOCKING__MOST; k++) x[i] -= l[k][i] * x[k];
        x[i] /= l[i][i];
    }
    return 1;
}

/* Minimises the sum of squares by at most 200 steps of the Levenberg-Marquardt method. */
static inline void blocking__law_descend(const blocking__tests *all, blocking__law_trial *trial) {
    double damping = 1e-3;
    int quiet = 0;
    blocking__law_sums(all, trial);
    for (int it = 0; it < 200 && quiet < 3 && damping < 1e10; it++) {
        blocking__law_trial next = *trial;
        double step[BLOCKING__MOST];
        for (int j = 0; j < BLOCKING__MOST; j++) step[j] = -trial->gradient[j];
        if (blocking__law_solve(trial, damping, step)) {
            for (int j = 0; j < BLOCKING__MOST; j++) next.x[j] += blocking__clip(step[j], -2.0, 2.0);
            blocking__law_sums(all, &next);
            if (next.sse <= trial->sse) {
                quiet = trial->sse - next.sse <= 1e-12 * trial->sse ? quiet + 1 : 0;
                *trial = next;
                damping *= 0.1;
                continue;
            }
        }
        damping = damping < 1e-9 ? 1e-8 : 10.0 * damping;
    }
}

static inline int blocking__bits(int mask) { return (mask & 1) + (mask >> 1 & 1) + (mask >> 2 & 1) + (mask >> 3 & 1); }

/* Finds constant k1 and k2: the best of a grid over the range that the times can show, refined by descent. */
static inline void blocking__law_start(const blocking__tests *all, blocking__law_trial *best) {
    enum { GRID = 24 };
    double last = 0.0, gap = HUGE_VAL;
    for (size_t s = 0; s < all->n; s++) {
        const blocking_test *test = &all->test[s];
        if (test->t[test->n - 1] > last) last = test->t[test->n - 1];
        for (size_t i = 1; i < test->n; i++)
            if (test->t[i] - test->t[i - 1] < gap) gap = test->t[i] - test->t[i - 1];
    }
    const double low = riddle_log(1e-3 / last), high = riddle_log(10.0 / gap);
    blocking__law_trial trial;
    trial.used_a = trial.used_b = 1;
    trial.terms = 2;
    for (int j = 0; j < BLOCKING__MOST; j++) trial.x[j] = 0.0;
    best->sse = HUGE_VAL;
    for (int i = 0; i < GRID * GRID; i++) {
        trial.x[0] = low + (high - low) * (i % GRID) / (double)(GRID - 1);
        trial.x[BLOCKING_LAW_TERMS] = low + (high - low) * (i / GRID) / (double)(GRID - 1);
        blocking__law_sums(all, &trial);
        if (trial.sse < best->sse) *best = trial;
    }
    blocking__law_descend(all, best);
}

static inline blocking_status blocking__check_tests(const blocking_test *tests, size_t n, blocking__tests *all,
                                                    size_t *bad) {
    double low[3] = {0.0, 0.0, 0.0}, high[3] = {0.0, 0.0, 0.0};
    all->test = tests;
    all->n = n;
    all->readings = 0;
    for (size_t s = 0; s < n; s++) {
        const blocking_test *test = &tests[s];
        *bad = s;
        if (!test->t || !test->f || (test->sigma != NULL) != (tests[0].sigma != NULL)) return BLOCKING_BAD_ARGUMENT;
        if (test->n < 2) return BLOCKING_TOO_FEW;
        blocking_status status = blocking__check_readings(test->t, test->f, test->n);
        if (status == BLOCKING_OK) status = blocking__check_sigma(test->sigma, test->n);
        if (status != BLOCKING_OK) return status;
        for (int j = 0; j < 3; j++) {
            double x = blocking__covariate(test, j);
            if (!(fabs(x) <= 1e100)) return BLOCKING_NOT_FINITE;
            if (s == 0 || x < low[j]) low[j] = x;
            if (s == 0 || x > high[j]) high[j] = x;
        }
        all->readings += test->n;
    }
    *bad = n;
    for (int j = 0; j < 3; j++) {
        all->centre[j] = 0.5 * (low[j] + high[j]);
        all->width[j] = high[j] - low[j] > 1e-12 * fabs(high[j]) ? 0.5 * (high[j] - low[j]) : 0.0;
    }
    return BLOCKING_OK;
}

static inline double blocking__aicc(const blocking__tests *all, const blocking__law_trial *trial) {
    const int known = all->test[0].sigma != NULL;
    double n = (double)all->readings, q = trial->terms + (double)all->n + (known ? 0.0 : 1.0);
    if (!(n - q - 1.0 > 0.0)) return HUGE_VAL;
    double fit = known ? trial->sse : n * riddle_log((trial->sse > 1e-30 * n ? trial->sse : 1e-30 * n) / n);
    return fit + 2.0 * q + 2.0 * q * (q + 1.0) / (n - q - 1.0);
}

/* Converts scaled covariates to plain ones: a_j = x_j/width_j; the shift of the centres goes into a_0. spread:
   covariance of x. */
static inline void blocking__law_plain(const blocking__tests *all, const blocking__law_trial *trial,
                                       double spread[BLOCKING__MOST][BLOCKING__MOST], blocking_law *out) {
    double map[BLOCKING__MOST][BLOCKING__MOST] = {{0.0}}, half[BLOCKING__MOST][BLOCKING__MOST];
    for (int i = 0; i < BLOCKING__MOST; i++) {
        int first = i - i % BLOCKING_LAW_TERMS, j = i % BLOCKING_LAW_TERMS;
        map[i][i] = j == 0 ? 1.0 : all->width[j - 1] > 0.0 ? 1.0 / all->width[j - 1] : 0.0;
        if (j > 0) map[first][i] = -map[i][i] * all->centre[j - 1];
    }
    for (int i = 0; i < BLOCKING__MOST; i++) {
        double value = 0.0;
        for (int j = 0; j < BLOCKING__MOST; j++) {
            value += map[i][j] * trial->x[j];
            half[i][j] = 0.0;
            for (int k = 0; k < BLOCKING__MOST; k++) half[i][j] += map[i][k] * spread[k][j];
        }
        *(i < BLOCKING_LAW_TERMS ? &out->a[i] : &out->b[i - BLOCKING_LAW_TERMS]) = value;
    }
    for (int i = 0; i < BLOCKING__MOST; i++)
        for (int j = 0; j < BLOCKING__MOST; j++) {
            out->covariance[i][j] = 0.0;
            for (int k = 0; k < BLOCKING__MOST; k++) out->covariance[i][j] += half[i][k] * map[j][k];
        }
}

/* Results of single tests: sums over those that determine their own k1 and k2, of the terms' products and of the terms
   times ln k1, ln k2. */
typedef struct blocking__law_guess {
    double product[BLOCKING_LAW_TERMS][BLOCKING_LAW_TERMS], with[2][BLOCKING_LAW_TERMS];
} blocking__law_guess;

static inline void blocking__law_single(const blocking__tests *all, blocking__law_guess *guess) {
    for (int i = 0; i < BLOCKING_LAW_TERMS; i++) {
        guess->with[0][i] = guess->with[1][i] = 0.0;
        for (int j = 0; j < BLOCKING_LAW_TERMS; j++) guess->product[i][j] = 0.0;
    }
    for (size_t s = 0; s < all->n; s++) {
        blocking__tests one = *all;
        blocking__law_trial alone;
        double unused[BLOCKING__MOST] = {0.0};
        one.test = &all->test[s];
        one.n = 1;
        blocking__law_start(&one, &alone);
        if (!blocking__law_solve(&alone, 0.0, unused) || !(alone.x[0] > -30.0 && alone.x[BLOCKING_LAW_TERMS] > -30.0))
            continue;
        for (int i = 0; i < BLOCKING_LAW_TERMS; i++) {
            double z = blocking__term(all, one.test, i);
            guess->with[0][i] += z * alone.x[0];
            guess->with[1][i] += z * alone.x[BLOCKING_LAW_TERMS];
            for (int j = 0; j < BLOCKING_LAW_TERMS; j++) guess->product[i][j] += z * blocking__term(all, one.test, j);
        }
    }
}

/* Computes a form's coefficients by linear regression of the results of single tests. A weak penalty keeps all terms
   but the first near 0 where the tests are too few. sse is infinite if there is no solution. */
static inline void blocking__law_regress(const blocking__law_guess *guess, blocking__law_trial *trial) {
    blocking__law_trial line = *trial;
    for (int i = 0; i < BLOCKING__MOST; i++) {
        trial->x[i] = guess->with[i / BLOCKING_LAW_TERMS][i % BLOCKING_LAW_TERMS];
        for (int j = 0; j < BLOCKING__MOST; j++) {
            int same = i / BLOCKING_LAW_TERMS == j / BLOCKING_LAW_TERMS,
                on = (trial->used_a | trial->used_b << BLOCKING_LAW_TERMS) >> i &
                     (trial->used_a | trial->used_b << BLOCKING_LAW_TERMS) >> j & 1;
            line.normal[i][j] = same && on ? guess->product[i % BLOCKING_LAW_TERMS][j % BLOCKING_LAW_TERMS] : 0.0;
            if (i == j && i % BLOCKING_LAW_TERMS) line.normal[i][j] += on ? 1e-3 * guess->product[0][0] : 0.0;
        }
        if (!((trial->used_a | trial->used_b << BLOCKING_LAW_TERMS) >> i & 1)) trial->x[i] = 0.0;
    }
    if (!blocking__law_solve(&line, 0.0, trial->x)) trial->sse = HUGE_VAL;
}

/* Descends from *trial and from the results of single tests, and keeps the better form. */
static inline void blocking__law_best(const blocking__tests *all, const blocking__law_guess *guess,
                                      blocking__law_trial *trial) {
    blocking__law_trial other = *trial;
    blocking__law_descend(all, trial);
    other.sse = 0.0;
    blocking__law_regress(guess, &other);
    if (!(other.sse < HUGE_VAL)) return;
    blocking__law_descend(all, &other);
    if (other.sse < trial->sse) *trial = other;
}

/* All forms. Bits 0 to 2 of a form's number: the terms of a; bits 3 to 5: those of b. */
enum { BLOCKING__FORMS = 64 };
typedef struct blocking__law_set {
    blocking__law_trial form[BLOCKING__FORMS];
    double aicc[BLOCKING__FORMS]; /* infinite: not available */
    int best;
} blocking__law_set;

/* Fits every form, from its best parent with one term less and from single tests, and selects the best by AICc. */
static inline void blocking__law_forms(const blocking__tests *all, blocking__law_set *set) {
    blocking__law_trial *form = set->form;
    blocking__law_guess guess;
    blocking__law_single(all, &guess);
    blocking__law_start(all, &form[0]);
    blocking__law_best(all, &guess, &form[0]);
    set->best = 0;
    set->aicc[0] = blocking__aicc(all, &form[0]);
    for (int terms = 1; terms <= 6; terms++)
        for (int f = 1; f < BLOCKING__FORMS; f++) {
            int a = f & 7, b = f >> 3, parent = -1, idle = 0;
            double unused[BLOCKING__MOST] = {0.0};
            if (blocking__bits(a) + blocking__bits(b) != terms) continue;
            for (int j = 0; j < 3; j++) idle |= !(all->width[j] > 0.0) && ((a | b) >> j & 1);
            form[f].sse = set->aicc[f] = HUGE_VAL;
            for (int j = 0; j < 6; j++)
                if ((f >> j & 1) && (parent < 0 || form[f ^ (1 << j)].sse < form[parent].sse)) parent = f ^ (1 << j);
            if (idle || parent < 0 || !(form[parent].sse < HUGE_VAL)) continue;
            form[f] = form[parent];
            form[f].used_a = 1 | a << 1;
            form[f].used_b = 1 | b << 1;
            form[f].terms = 2 + terms;
            blocking__law_best(all, &guess, &form[f]);
            if (blocking__law_solve(&form[f], 0.0, unused)) set->aicc[f] = blocking__aicc(all, &form[f]);
            if (set->aicc[f] < set->aicc[set->best]) set->best = f;
        }
}

static inline double blocking__law_dof(const blocking__tests *all, const blocking__law_trial *trial) {
    return (double)all->readings - (double)all->n - trial->terms;
}

/* Computes the covariance of the best form's coefficients, including the choice of the form: every form counts by its
   Akaike weight, with its own covariance and the square of its difference from the best (Burnham and Anderson 2002,
   section 4.3). NaN where the best has none. */
static inline void blocking__law_spread(const blocking__tests *all, const blocking__law_set *set,
                                        double spread[BLOCKING__MOST][BLOCKING__MOST]) {
    double weights = 0.0;
    for (int i = 0; i < BLOCKING__MOST; i++)
        for (int j = 0; j < BLOCKING__MOST; j++) spread[i][j] = 0.0;
    for (int f = 0; f < BLOCKING__FORMS; f++) {
        const double behind = set->aicc[f] - set->aicc[set->best],
                     weight = f == set->best ? 1.0 : riddle_exp(-0.5 * behind);
        if (f != set->best && !(behind < 40.0)) continue;
        const blocking__law_trial *form = &set->form[f];
        const double variance = all->test[0].sigma ? 1.0 : form->sse / blocking__law_dof(all, form);
        for (int i = 0; i < BLOCKING__MOST; i++) {
            double column[BLOCKING__MOST] = {0.0};
            int on = (i < BLOCKING_LAW_TERMS ? form->used_a >> i : form->used_b >> (i - BLOCKING_LAW_TERMS)) & 1;
            column[i] = on;
            if (on && !blocking__law_solve(form, 0.0, column))
                for (int j = 0; j < BLOCKING__MOST; j++) column[j] = f == set->best ? (double)NAN : 0.0;
            for (int j = 0; j < BLOCKING__MOST; j++)
                spread[j][i] += weight * (variance * column[j] + (form->x[i] - set->form[set->best].x[i]) *
                                                                     (form->x[j] - set->form[set->best].x[j]));
        }
        weights += weight;
    }
    for (int i = 0; i < BLOCKING__MOST; i++)
        for (int j = 0; j < BLOCKING__MOST; j++) spread[i][j] /= weights;
}

BLOCKING_API blocking_status blocking_fit_law(const blocking_test *tests, size_t n_tests, blocking_law *out,
                                              size_t *test) {
    size_t ignored;
    blocking__tests all;
    if (!test) test = &ignored;
    *test = 0;
    if (!out || !tests) return BLOCKING_BAD_ARGUMENT;
    out->tests = out->readings = 0;
    out->used_a = out->used_b = 0;
    for (int i = 0; i < BLOCKING_LAW_TERMS; i++) out->a[i] = out->b[i] = (double)NAN;
    out->aicc = out->aicc_constant = out->sse = out->dof = out->s = out->student = (double)NAN;
    for (int i = 0; i < BLOCKING__MOST; i++)
        for (int j = 0; j < BLOCKING__MOST; j++) out->covariance[i][j] = (double)NAN;
    if (n_tests == 0) return BLOCKING_TOO_FEW;
    blocking_status status = blocking__check_tests(tests, n_tests, &all, test);
    if (status != BLOCKING_OK) return status;
    if (all.readings < n_tests + 3) return BLOCKING_TOO_FEW;
    blocking__law_set set;
    double spread[BLOCKING__MOST][BLOCKING__MOST];
    blocking__law_forms(&all, &set);
    const blocking__law_trial *best = &set.form[set.best];
    out->tests = n_tests;
    out->readings = all.readings;
    out->aicc = set.aicc[set.best];
    out->aicc_constant = set.aicc[0];
    out->used_a = best->used_a;
    out->used_b = best->used_b;
    out->sse = best->sse;
    out->dof = blocking__law_dof(&all, best);
    out->s = tests[0].sigma ? 1.0 : sqrt(best->sse / out->dof);
    out->student = blocking_student(1.959963984540054, tests[0].sigma ? HUGE_VAL : out->dof);
    for (int j = 0; j < 3; j++) {
        out->low[j] = all.centre[j] - all.width[j];
        out->high[j] = all.centre[j] + all.width[j];
    }
    blocking__law_spread(&all, &set, spread);
    blocking__law_plain(&all, best, spread, out);
    return out->covariance[0][0] == out->covariance[0][0] ? BLOCKING_OK : BLOCKING_UNDETERMINED;
}

/* Returns the variance of a . z (of_a 1, of_b 0), of b . z (of_a 0, of_b 1) or of their difference (1 and -1). */
static inline double blocking__law_variance(const blocking_law *law, const double *z, double of_a, double of_b) {
    double sum = 0.0;
    for (int i = 0; i < BLOCKING__MOST; i++)
        for (int j = 0; j < BLOCKING__MOST; j++)
            sum += (i < BLOCKING_LAW_TERMS ? of_a : of_b) * z[i % BLOCKING_LAW_TERMS] *
                   (j < BLOCKING_LAW_TERMS ? of_a : of_b) * z[j % BLOCKING_LAW_TERMS] * law->covariance[i][j];
    return sum > 0.0 ? sum : 0.0;
}

BLOCKING_API blocking_status blocking_law_at(const blocking_law *law, double K, double x_h, double moisture,
                                             blocking_law_value *out) {
    if (!out) return BLOCKING_BAD_ARGUMENT;
    out->k1 = out->k2 = out->f_inf = out->k1_low95 = out->k1_high95 = out->k2_low95 = out->k2_high95 = (double)NAN;
    out->f_inf_low95 = out->f_inf_high95 = (double)NAN;
    out->outside = 0;
    if (!law || law->tests == 0) return BLOCKING_BAD_ARGUMENT;
    const double x[3] = {K, x_h, moisture}, z[BLOCKING_LAW_TERMS] = {1.0, K, x_h, moisture};
    double log_k1 = 0.0, log_k2 = 0.0;
    for (int j = 0; j < 3; j++) {
        if (!blocking__finite(x[j])) return BLOCKING_NOT_FINITE;
        double edge = 0.01 * (law->high[j] - law->low[j]);
        if (x[j] < law->low[j] - edge || x[j] > law->high[j] + edge) out->outside |= 1 << j;
    }
    for (int j = 0; j < BLOCKING_LAW_TERMS; j++) {
        log_k1 += law->a[j] * z[j];
        log_k2 += law->b[j] * z[j];
    }
    const double r1 = law->student * sqrt(blocking__law_variance(law, z, 1.0, 0.0)),
                 r2 = law->student * sqrt(blocking__law_variance(law, z, 0.0, 1.0)),
                 rf = law->student * sqrt(blocking__law_variance(law, z, 1.0, -1.0)), odds = log_k1 - log_k2;
    if (!(fabs(log_k1) < 700.0 && fabs(log_k2) < 700.0)) return BLOCKING_NOT_FINITE;
    out->k1 = riddle_exp(log_k1);
    out->k2 = riddle_exp(log_k2);
    out->f_inf = 1.0 / (1.0 + riddle_exp(odds));
    out->k1_low95 = riddle_exp(log_k1 - r1);
    out->k1_high95 = riddle_exp(log_k1 + r1);
    out->k2_low95 = riddle_exp(log_k2 - r2);
    out->k2_high95 = riddle_exp(log_k2 + r2);
    out->f_inf_low95 = 1.0 / (1.0 + riddle_exp(odds + rf));
    out->f_inf_high95 = 1.0 / (1.0 + riddle_exp(odds - rf));
    return BLOCKING_OK;
}

/* ln k1, ln k2 and the lower Cholesky factor of their errors' covariance, times Student's t */
typedef struct blocking__law_place {
    double log_k1, log_k2, l11, l21, l22;
    int outside;
} blocking__law_place;

static inline blocking_status blocking__law_place_of(const blocking_law *law, double K, double x_h, double moisture,
                                                     blocking__law_place *out) {
    blocking_law_value value;
    const double z[BLOCKING_LAW_TERMS] = {1.0, K, x_h, moisture};
    blocking_status status = blocking_law_at(law, K, x_h, moisture, &value);
    if (status != BLOCKING_OK) return status;
    const double v1 = blocking__law_variance(law, z, 1.0, 0.0), v2 = blocking__law_variance(law, z, 0.0, 1.0),
                 both = blocking__law_variance(law, z, 1.0, -1.0), common = 0.5 * (v1 + v2 - both);
    const double slope = v1 > 0.0 ? common / v1 : 0.0, rest = v2 - slope * common;
    out->log_k1 = riddle_log(value.k1);
    out->log_k2 = riddle_log(value.k2);
    out->l11 = law->student * sqrt(v1);
    out->l21 = law->student * slope * sqrt(v1);
    out->l22 = law->student * sqrt(rest > 0.0 ? rest : 0.0);
    out->outside = value.outside;
    return law->covariance[0][0] == law->covariance[0][0] ? BLOCKING_OK : BLOCKING_UNDETERMINED;
}

static inline void blocking__law_pair(const blocking__law_place *place, double z1, double z2, double *k1, double *k2) {
    *k1 = riddle_exp(place->log_k1 + place->l11 * z1);
    *k2 = riddle_exp(place->log_k2 + place->l21 * z1 + place->l22 * z2);
}

BLOCKING_API blocking_status blocking_law_draw(const blocking_law *law, double K, double x_h, double moisture,
                                               double z1, double z2, double *k1, double *k2) {
    blocking__law_place place;
    if (!k1 || !k2) return BLOCKING_BAD_ARGUMENT;
    *k1 = *k2 = (double)NAN;
    if (!blocking__finite(z1) || !blocking__finite(z2)) return BLOCKING_NOT_FINITE;
    blocking_status status = blocking__law_place_of(law, K, x_h, moisture, &place);
    if (status != BLOCKING_OK) return status;
    blocking__law_pair(&place, z1 / 1.959963984540054, z2 / 1.959963984540054, k1, k2);
    if (blocking__finite(*k1 + *k2) && *k1 + *k2 > 0.0) return BLOCKING_OK;
    *k1 = *k2 = (double)NAN;
    return BLOCKING_NOT_FINITE;
}

static inline void blocking__widen(double x, double *low, double *high) {
    if (!(x >= *low)) *low = x;
    if (!(x <= *high)) *high = x;
}

BLOCKING_API blocking_status blocking_law_free(const blocking_law *law, double K, double x_h, double moisture,
                                               double f0, double T, blocking_law_run *out) {
    enum { PLACES = 256 }; /* on the boundary of the allowed region, where the extremes are: f falls with k1 and rises
                              with k2 */
    blocking__law_place place;
    if (!out) return BLOCKING_BAD_ARGUMENT;
    out->last = out->mean = out->last_low95 = out->last_high95 = out->mean_low95 = out->mean_high95 = (double)NAN;
    out->outside = 0;
    if (f0 != f0 || T != T) return BLOCKING_NOT_FINITE;
    if (!blocking__within(f0, 0.0, 1.0) || !(T >= 0.0)) return BLOCKING_BAD_ARGUMENT;
    blocking_status status = blocking__law_place_of(law, K, x_h, moisture, &place);
    if (status != BLOCKING_OK) return status;
    out->outside = place.outside;
    for (int i = -1; i < PLACES; i++) { /* first the law's own */
        double angle = 2.0 * RIDDLE_PI * i / (double)PLACES, k1, k2;
        blocking__law_pair(&place, i < 0 ? 0.0 : riddle_cos(angle), i < 0 ? 0.0 : riddle_sin(angle), &k1, &k2);
        double k = k1 + k2, f_inf = blocking__finite(k) && k > 0.0 ? k2 / k : (double)NAN;
        double last = blocking_curve(f0, f_inf, k, T), mean = blocking_time_mean(f0, f_inf, k, T);
        if (i < 0) out->last = last;
        if (i < 0) out->mean = mean;
        if (last == last) blocking__widen(last, &out->last_low95, &out->last_high95);
        if (mean == mean) blocking__widen(mean, &out->mean_low95, &out->mean_high95);
    }
    return BLOCKING_OK;
}

/* ==================================================== >>table3 ==================================================== */

BLOCKING_API blocking_conditions blocking_default_conditions(void) {
    blocking_conditions c;
    c.K = c.x_h = (double)NAN;
    c.opening = 1e-3;
    c.grain_min = 0.2e-3;
    c.grain_max = 2.5e-3;
    c.moisture = 0.0;
    return c;
}

BLOCKING_API unsigned blocking_outside_box(const blocking_conditions *c) {
    const double edge = 4.0 * BLOCKING__EDGE;
    unsigned flags = 0;
    if (!c) return BLOCKING_FLAG_BOX;
    if (!blocking__within(c->K, 0.62 - edge, 4.9 + edge)) flags |= BLOCKING_FLAG_K;
    if (!blocking__within(c->opening, 0.5e-3 - edge, 1.2e-3 + edge)) flags |= BLOCKING_FLAG_OPENING;
    if (!(c->grain_min >= 0.2e-3 - edge && c->grain_max <= 2.5e-3 + edge)) flags |= BLOCKING_FLAG_GRAINS;
    if (!(c->moisture == 0.0)) flags |= BLOCKING_FLAG_MOIST;
    return flags;
}

BLOCKING_API blocking_status blocking_average_free(blocking_shape shape, const blocking_conditions *conditions,
                                                   blocking_average *out) {
    if (!out) return BLOCKING_BAD_ARGUMENT;
    out->value = out->raw = out->slope = (double)NAN;
    out->flags = 0;
    if (!conditions || !((int)shape >= 0 && shape < BLOCKING_SHAPE_COUNT)) return BLOCKING_BAD_ARGUMENT;
    if (!blocking__finite(conditions->K)) return BLOCKING_NOT_FINITE;
    if (conditions->K < 0.0) return BLOCKING_NEGATIVE;
    blocking_status status = blocking__check_fraction(conditions->x_h);
    if (status != BLOCKING_OK) return status;
    double raw = blocking_table3(shape, conditions->K, conditions->x_h),
           slope = blocking_table3_slope(shape, conditions->K, conditions->x_h);
    if (!blocking__finite(raw) || !blocking__finite(slope)) return BLOCKING_NOT_FINITE; /* K beyond 1e100 */
    out->raw = raw;
    out->slope = slope;
    out->value = blocking__clip(out->raw, 0.0, 1.0);
    out->flags = blocking_outside_box(conditions);
    if (out->raw > 1.0) out->flags |= BLOCKING_FLAG_ABOVE_ONE;
    if (out->raw < 0.0) out->flags |= BLOCKING_FLAG_NEGATIVE;
    if (out->slope > 0.0) out->flags |= BLOCKING_FLAG_RISING;
    return BLOCKING_OK;
}

/* ================================================== >>polynomial ================================================== */

static inline double blocking__monomial(const int *power, const double *x, size_t n_vars) {
    double y = 1.0;
    for (size_t j = 0; j < n_vars; j++) {
        if (power[j] < 0) return (double)NAN;
        double base = x[j];
        for (unsigned p = (unsigned)power[j]; p; p >>= 1) {
            if (p & 1u) y *= base;
            base *= base;
        }
    }
    return y;
}

BLOCKING_API double blocking_polynomial(const double *a, const int *powers, size_t n_terms, const double *x,
                                        size_t n_vars) {
    double y = 0.0;
    if (n_terms > 0 && (!a || (n_vars > 0 && (!powers || !x)))) return (double)NAN;
    for (size_t i = 0; i < n_terms; i++) y += a[i] * blocking__monomial(powers + i * n_vars, x, n_vars);
    return y;
}

BLOCKING_API size_t blocking_polynomial_powers(size_t n_vars, int degree, int *powers, size_t capacity) {
    if (n_vars == 0 || degree < 0) return 0;
    double number = 1.0;
    for (int i = 1; i <= degree && number <= 1e9; i++) number = number * ((double)n_vars + i) / i;
    if (!(number <= 1e9)) return 0;
    size_t rows = (size_t)(number + 0.5);
    if (!powers || capacity < rows) return rows;
    for (size_t j = 0; j < n_vars; j++) powers[j] = 0;
    for (size_t row = 1; row < rows; row++) {
        const int *before = powers + (row - 1) * n_vars;
        int *now = powers + row * n_vars;
        size_t last = n_vars - 1, j = n_vars;
        for (size_t i = 0; i < n_vars; i++) now[i] = before[i];
        /* the last variable's power is handed on: to the one after the rightmost other power, or to a new degree */
        int tail = now[last];
        now[last] = 0;
        while (j > 0 && (j - 1 == last || now[j - 1] == 0)) j--;
        if (j == 0) now[0] = tail + 1;
        else {
            now[j - 1]--;
            now[j] = tail + 1;
        }
    }
    return rows;
}

/* Solves for the coefficients of the scaled columns with right-hand side b, which is overwritten. q: Householder
   vectors below, R above the diagonal, column by column; diagonal: of R; beta: 2/|v|^2. */
static inline void blocking__qr_solve(const double *q, const double *diagonal, const double *beta, size_t rows,
                                      size_t columns, double *b) {
    for (size_t j = 0; j < columns; j++) {
        const double *v = q + j * rows;
        double dot = 0.0;
        for (size_t i = j; i < rows; i++) dot += v[i] * b[i];
        for (size_t i = j; i < rows; i++) b[i] -= beta[j] * dot * v[i];
    }
    for (size_t j = columns; j-- > 0;) {
        for (size_t c = j + 1; c < columns; c++) b[j] -= q[c * rows + j] * b[c];
        b[j] /= diagonal[j];
    }
}

BLOCKING_API blocking_status blocking_polynomial_fit(const double *x, const double *y, size_t n_points,
                                                     const int *powers, size_t n_terms, size_t n_vars, double *a,
                                                     double *error, double *work, blocking_polynomial_report *report) {
    blocking_polynomial_report own;
    blocking_polynomial_report *r = report ? report : &own;
    r->r2 = r->sse = r->deviation = (double)NAN;
    r->term = n_terms;
    if (n_terms > 0 && !a) return BLOCKING_BAD_ARGUMENT;
    for (size_t j = 0; j < n_terms; j++) {
        a[j] = (double)NAN;
        if (error) error[j] = (double)NAN;
    }
    if (n_terms == 0 || n_points < n_terms) return BLOCKING_TOO_FEW;
    if (!x || !y || !powers || !work || n_vars == 0) return BLOCKING_BAD_ARGUMENT;
    for (size_t i = 0; i < n_terms * n_vars; i++)
        if (powers[i] < 0) return BLOCKING_BAD_ARGUMENT;

    double *q = work, *b = q + n_points * n_terms, *residual = b + n_points, *scale = residual + n_points,
           *diagonal = scale + n_terms, *beta = diagonal + n_terms, *inverse = beta + n_terms;
    double y_mean = 0.0, sst = 0.0;
    for (size_t i = 0; i < n_points; i++) {
        for (size_t j = 0; j < n_terms; j++)
            q[j * n_points + i] = blocking__monomial(powers + j * n_vars, x + i * n_vars, n_vars);
        b[i] = y[i];
        y_mean += (y[i] - y[0]) / (double)n_points; /* about y[0]: the mean of equal values is that value */
    }
    y_mean += y[0];
    for (size_t i = 0; i < n_points; i++) sst += blocking__square(y[i] - y_mean);
    if (!blocking__finite(sst)) return BLOCKING_NOT_FINITE;
    for (size_t j = 0; j < n_terms; j++) {
        double *v = q + j * n_points, norm = 0.0;
        for (size_t i = 0; i < n_points; i++) norm += v[i] * v[i];
        if (!blocking__finite(norm)) return BLOCKING_NOT_FINITE;
        scale[j] = norm > 0.0 ? 1.0 / sqrt(norm) : 0.0;
        for (size_t i = 0; i < n_points; i++) v[i] *= scale[j];
    }
    for (size_t j = 0; j < n_terms; j++) {
        double *v = q + j * n_points, norm = 0.0;
        for (size_t i = j; i < n_points; i++) norm += v[i] * v[i];
        norm = sqrt(norm);
        if (!(norm > 1e-12)) {
            r->term = j;
            return BLOCKING_UNDETERMINED;
        }
        diagonal[j] = v[j] > 0.0 ? -norm : norm;
        v[j] -= diagonal[j];
        beta[j] = -1.0 / (diagonal[j] * v[j]);
        for (size_t c = j + 1; c < n_terms; c++) {
            double *w = q + c * n_points, dot = 0.0;
            for (size_t i = j; i < n_points; i++) dot += v[i] * w[i];
            for (size_t i = j; i < n_points; i++) w[i] -= beta[j] * dot * v[i];
        }
    }
    blocking__qr_solve(q, diagonal, beta, n_points, n_terms, b);
    for (size_t j = 0; j < n_terms; j++) a[j] = b[j] * scale[j];
    for (int pass = 0; pass < 2; pass++) { /* residual, one refinement, residual */
        r->sse = 0.0;
        for (size_t i = 0; i < n_points; i++) {
            residual[i] = y[i] - blocking_polynomial(a, powers, n_terms, x + i * n_vars, n_vars);
            r->sse += residual[i] * residual[i];
        }
        if (pass == 1) break;
        blocking__qr_solve(q, diagonal, beta, n_points, n_terms, residual);
        for (size_t j = 0; j < n_terms; j++) a[j] += residual[j] * scale[j];
    }
    if (sst > 0.0) r->r2 = 1.0 - r->sse / sst;
    if (n_points == n_terms) return BLOCKING_OK;
    r->deviation = sqrt(r->sse / (double)(n_points - n_terms));
    for (size_t j = 0; error && j < n_terms; j++) error[j] = 0.0;
    for (size_t c = 0; error && c < n_terms; c++) { /* column c of the inverse of R */
        inverse[c] = 1.0 / diagonal[c];
        for (size_t j = c; j-- > 0;) {
            double sum = 0.0;
            for (size_t m = j + 1; m <= c; m++) sum -= q[m * n_points + j] * inverse[m];
            inverse[j] = sum / diagonal[j];
        }
        for (size_t j = 0; j <= c; j++) error[j] += inverse[j] * inverse[j];
    }
    for (size_t j = 0; error && j < n_terms; j++) error[j] = r->deviation * scale[j] * sqrt(error[j]);
    return BLOCKING_OK;
}

/* ==================================================== >>design ==================================================== */

BLOCKING_API blocking_duty blocking_default_duty(void) {
    blocking_duty duty;
    duty.passing = duty.capacity = duty.clearance = duty.f_inf = duty.k = (double)NAN;
    duty.f0 = 1.0;
    duty.run_time = HUGE_VAL;
    duty.mean_lowest = duty.mean_highest = duty.last_lowest = duty.last_highest = (double)NAN;
    duty.cookie = BLOCKING__COOKIE_DUTY;
    return duty;
}

/* Returns whether low and high are a range within 0..1, or both NaN: no range. */
static inline int blocking__is_range(double low, double high) {
    return (low != low && high != high) || (low >= 0.0 && low <= high && high <= 1.0);
}

BLOCKING_API blocking_status blocking_check_duty(const blocking_duty *duty, const char **field) {
    const char *bad = NULL;
    if (!duty) bad = "duty";
    else if (duty->cookie != BLOCKING__COOKIE_DUTY) bad = "cookie";
    else if (!(duty->passing > 0.0 && blocking__finite(duty->passing))) bad = "passing";
    else if (!(duty->capacity > 0.0 && duty->passing / duty->capacity > 0.0 &&
               blocking__finite(duty->passing / duty->capacity)))
        bad = "capacity";
    else if (!(duty->clearance > 0.0 && duty->clearance <= 1.0 &&
               blocking__finite(duty->passing / duty->capacity / duty->clearance)))
        bad = "clearance";
    else if (!blocking__within(duty->f0, 0.0, 1.0)) bad = "f0";
    else if (!blocking__within(duty->f_inf, 0.0, 1.0)) bad = "f_inf";
    else if (!(duty->k >= 0.0 && blocking__finite(duty->k))) bad = "k";
    else if (!(duty->run_time >= 0.0)) bad = "run_time";
    else if (!blocking__is_range(duty->mean_lowest, duty->mean_highest)) bad = "mean_lowest";
    else if (!blocking__is_range(duty->last_lowest, duty->last_highest)) bad = "last_lowest";
    if (field) *field = bad;
    return bad ? BLOCKING_BAD_DEF : BLOCKING_OK;
}

BLOCKING_API blocking_status blocking_design(const blocking_duty *duty, blocking_deck *out) {
    if (!out) return BLOCKING_BAD_ARGUMENT;
    out->free_mean = out->free_lowest = out->effective_area = out->area_clean = out->area_mean = out->area_lowest =
        (double)NAN;
    out->area_mean_low95 = out->area_mean_high95 = out->area_lowest_low95 = out->area_lowest_high95 = (double)NAN;
    if (blocking_check_duty(duty, NULL) != BLOCKING_OK) return BLOCKING_BAD_DEF;
    double last = blocking_curve(duty->f0, duty->f_inf, duty->k, duty->run_time);
    out->free_mean = blocking_time_mean(duty->f0, duty->f_inf, duty->k, duty->run_time);
    out->free_lowest = last < duty->f0 ? last : duty->f0;
    out->effective_area = duty->passing / duty->capacity;
    out->area_clean = out->effective_area / duty->clearance;
    out->area_mean = out->area_clean / out->free_mean;
    out->area_lowest = out->area_clean / out->free_lowest;
    out->area_mean_low95 = out->area_clean / duty->mean_highest;
    out->area_mean_high95 = out->area_clean / duty->mean_lowest;
    out->area_lowest_low95 = out->area_clean / (duty->last_highest < duty->f0 ? duty->last_highest : duty->f0);
    out->area_lowest_high95 = out->area_clean / (duty->last_lowest < duty->f0 ? duty->last_lowest : duty->f0);
    if (duty->last_lowest != duty->last_lowest) out->area_lowest_low95 = out->area_lowest_high95 = (double)NAN;
    return BLOCKING_OK;
}

#undef BLOCKING__COOKIE_ODE
#undef BLOCKING__COOKIE_FIT
#undef BLOCKING__COOKIE_DUTY
#endif /* BLOCKING__BODIES */
#undef BLOCKING__BODIES
#undef BLOCKING__EDGE

#ifdef __cplusplus
}
#endif
#endif /* BLOCKING_H */
