/* The filtration equation as its user sees it: laws, an operation, the evaluation of a measured curve, prediction. */
#pragma once
#include "../base/base.h"

/* ==== >>process: filtration equation (1) to (3), filter curves, compressible cakes ==== */

/* ---- laws. dp: pressure difference [Pa], mu: viscosity of the filtrate [Pa s], A: filter area [m2]; all > 0. product:
   r_K K_S [1/m2], the resistance per metre of cake times the cake volume per filtrate volume, >= 0. medium:
   R_M [1/m] >= 0. ---- */

/* (1) Returns the filtrate velocity dp / (mu (R_C + R_M)) [m/s]; cake, medium: resistances R_C, R_M >= 0, not both 0
   [1/m]. */
static inline double filtration_velocity(double dp, double mu, double cake, double medium);
/* (1) Returns the resistance dp / (mu v) [1/m]; velocity v > 0 [m/s]. */
static inline double filtration_resistance(double dp, double mu, double velocity);
/* Returns R_C = r_K h [1/m] of a cake of height h >= 0 [m]; specific: r_K >= 0 [1/m2]. */
static inline double filtration_cake_resistance(double specific, double height);
/* (2) Returns R_M = R_M0 + R_MI [1/m]: clean medium, and interference of the first layer; both >= 0. */
static inline double filtration_medium_resistance(double clean, double interference);
/* (3) Returns the slope mu r_K K_S / (2 A^2 dp) [s/m6] or the intercept mu R_M / (A dp) [s/m3] of t / V over V, or
   their inverses. */
static inline double filtration_slope(double product, double dp, double mu, double A);
static inline double filtration_intercept(double medium, double dp, double mu, double A);
static inline double filtration_product_of_slope(double slope, double dp, double mu, double A);        /* [1/m2] */
static inline double filtration_medium_of_intercept(double intercept, double dp, double mu, double A); /* [1/m] */
/* (3) Returns the time [s] for the filtrate volume V >= 0 [m3] at constant pressure, slope V^2 + intercept V; both >=
   0. */
static inline double filtration_time_of_volume(double slope, double intercept, double V);
/* Returns the volume [m3] after a time t >= 0 [s], the inverse; slope and intercept not both 0. */
static inline double filtration_volume_of_time(double slope, double intercept, double t);
/* Returns the pressure difference [Pa] at the filtrate velocity v >= 0 [m/s] after V / A = w >= 0 [m] of filtrate. */
static inline double filtration_pressure(double product, double medium, double mu, double v, double w);

/* Returns value_1 (p / p_1)^exponent, the power law of a compressible cake at the pressure difference p [Pa]; value_1
   >= 0, p >= 0, p_1 > 0. */
static inline double filtration_power_law(double value_1, double exponent, double p, double p_1);
/* Returns the mean over a cake whose local resistance follows the power law with exponent n, 0 <= n < 1: the local
   value at p times 1 - n (Tiller 1953). */
static inline double filtration_mean_of_local(double local, double n);
/* Returns the mean solid fraction of a cake [-] from the local one at p (power law with exponent beta >= 0), where the
   local resistance has the exponent n >= 0: (1 - n - beta) / (1 - n) of it; n + beta < 1. */
static inline double filtration_mean_solid(double local, double n, double beta);

#define FILTRATION_KOZENY_CARMAN 180.0 /* constant of Carman (1937); Ergun (1952): 150 */
/* Returns r_K by Kozeny-Carman, constant (1 - porosity)^2 / (porosity^3 d^2) [1/m2]; 0 < porosity <= 1, Sauter diameter
   d > 0 [m], constant > 0. */
static inline double filtration_kozeny_carman(double porosity, double d, double constant);
/* Returns the porosity [-] of a cake with r_K > 0, the inverse. */
static inline double filtration_kozeny_porosity(double specific, double d, double constant);
/* Returns K_S [-] from the solid volume fraction c of the suspension and the porosity e of the cake, c / (1 - e - c); c
   >= 0, c + e < 1. */
static inline double filtration_cake_ratio(double c, double porosity);
/* Returns K_S [-] from the solid volume in the cake, its porosity e and the filtrate volume V > 0 [m3], solid / ((1 -
   e) V). */
static inline double filtration_cake_ratio_of_solid(double solid, double porosity, double V);
/* Returns K_S [-] from the height of the cake, h A / V. */
static inline double filtration_cake_ratio_of_height(double height, double A, double V);
/* Returns the specific resistance by mass, alpha = r_K / (rho_s (1 - e)) [m/kg]; density of the solid > 0 [kg/m3]. */
static inline double filtration_mass_resistance(double specific, double porosity, double density);

/* Returns the two-sided quantile t of Student's distribution: P(|T| < t) = confidence; 0 < confidence < 1, freedom > 0,
   not necessarily an integer. */
static inline double filtration_student(double confidence, double freedom);

/* ---- size distributions: n classes of mean size d > 0 [m] (arrays of the caller, [n]) ---- */
/* Computes shares[i] d[i]^power, normalized to a sum of 1: power -3 turns volume shares (q3) into number shares (q0), 3
   turns them back. out may be shares. BAD_ARGUMENT: n 0, a share < 0, all 0, a size not > 0. */
FILTRATION_API filtration_status filtration_convert_shares(size_t n, const double *d, const double *shares,
                                                           double power, double *out);
/* Converts cumulative Q3 (0 .. 1, rising) at n >= 2 sizes x > 0 (rising) to Q0 at the same sizes: exact if Q3 is linear
   between them. Q3[0] must be 0, because the number below the first size is unknown. BAD_ARGUMENT. out may be Q3. */
FILTRATION_API filtration_status filtration_number_distribution(size_t n, const double *x, const double *Q3,
                                                                double *out);
/* Returns the Sauter diameter [m] of volume shares; NaN where filtration_convert_shares would refuse. */
FILTRATION_API double filtration_sauter(size_t n, const double *d, const double *volume_shares);

/* ---- an operation: constant rate until the pressure is reached, then constant pressure ---- */
typedef struct filtration_operation {
    double viscosity; /* of the filtrate [Pa s] > 0; default 1e-3 */
    double area;      /* [m2] > 0; default 1 */
    double medium;    /* R_M [1/m] >= 0; default 0 */
    double product;   /* r_K K_S [1/m2] >= 0, at `reference` if the cake is compressible; default 0 */
    double
        compressibility; /* exponent n of r_K K_S as a function of the pressure difference in the cake [-], 0 ..
                            below 1; default 0 */
    double reference; /* pressure difference in the cake at which product holds [Pa] > 0; default 1e5 */
    double pressure;  /* largest pressure difference [Pa] > 0; HUGE_VAL: no limit (constant rate); default 1e5 */
    double
        rate; /* filtrate flow of the first stage [m3/s] > 0; HUGE_VAL: constant pressure from the start;
                 default HUGE_VAL */
} filtration_operation;

typedef struct filtration_point {
    double time;     /* [s] */
    double volume;   /* of filtrate [m3] */
    double flow;     /* of filtrate [m3/s] */
    double pressure; /* difference over cake and medium [Pa] */
    double cake;     /* part of it in the cake [Pa] */
} filtration_point;

FILTRATION_API filtration_operation filtration_operation_default(void);
/* Returns BAD_ARGUMENT and the name of the first bad field (field may be NULL). Medium and product must not both be 0,
   pressure and rate not both HUGE_VAL. */
FILTRATION_API filtration_status filtration_operation_check(const filtration_operation *o, const char **field);
/* Finds the point at which the first stage ends. time infinite: it never ends; 0: there is no such stage. */
FILTRATION_API filtration_status filtration_change_over(const filtration_operation *o, filtration_point *point);
/* Computes the point at a filtrate volume >= 0 [m3], or at a time >= 0 [s]. NO_SOLUTION: out of the range of doubles.
   */
FILTRATION_API filtration_status filtration_at_volume(const filtration_operation *o, double volume,
                                                      filtration_point *point);
FILTRATION_API filtration_status filtration_at_time(const filtration_operation *o, double time,
                                                    filtration_point *point);

/* ---- evaluation of a measured filter curve, in the manner of VDI 2762 ---- */
typedef struct filtration_curve_def {
    uint32_t cookie;   /* set by filtration_curve_default_def() */
    double pressure;   /* difference, constant [Pa] > 0; default 1e5 */
    double viscosity;  /* [Pa s] > 0; default 1e-3 */
    double area;       /* [m2] > 0; default 2e-3 */
    double cake_ratio; /* K_S [-] > 0; NAN: unknown, then only the product r_K K_S is determined; default NAN */
    double
        solids; /* mass of dry solids in the cake over the volume of filtrate [kg/m3] > 0; NAN: unknown, then alpha is
                              not determined; default NAN */
    double pressure_error; /* standard errors, relative [-] >= 0; default 0 */
    double viscosity_error;
    double area_error;
    double cake_ratio_error;
    double solids_error;
    double
        time_error; /* standard error of a reading [s] >= 0; if volume_error is 0, too: unknown, and the readings tell
                              how their scatter grows; default 0 */
    double volume_error; /* [m3] >= 0; default 0. Both only weight the readings; intervals follow from the scatter */
    double
        drift_error; /* standard error of the last volume used, from a balance that drifts in proportion to time [m3] >=
                        0; default 0. Such a drift looks like another filter, so that readings hardly reveal it. 0: with
                        `independent` there is none; otherwise the intervals allow for one that changes the last reading
                        by seven times its scatter */
    int independent; /* 1: the errors of neighbours are known to be independent, and the balance does not drift; 0:
                        neither is known, and the intervals allow for errors that are alike or add up, and for a drift,
                        which makes them two to ten times as wide; default 0 */
    double
        start_time; /* of the stage that is evaluated [s]; default 0. Then (t - t1) / (V - V1) is fitted over V + V1 */
    double start_volume;   /* [m3] >= 0; default 0 */
    double first_volume;   /* readings from this filtrate volume on ... [m3] >= 0; default 0 */
    double last_volume;    /* ... to this one [m3]; default HUGE_VAL */
    int automatic;         /* 1: uses the longest straight stretch of these; 0: uses all; default 1 */
    size_t least_readings; /* of a stretch, >= 5; default 6. If there are no more readings than that, all are used */
    double
        bend_level; /* a stretch is bent if chance alone would bend it as much with less than this probability [-],
                       above 0 .. 1; default 0.1. If there is no straighter stretch, a fifth of this applies: then there
                       is no interval */
    double tolerance;  /* ... and if the bend exceeds this share of the mean t / V [-] >= 0; default 0.005 */
    double confidence; /* of intervals [-], above 0 .. below 1; default 0.95 */
} filtration_curve_def;

typedef struct filtration_estimate {
    double value;
    double error;     /* standard error */
    double low, high; /* confidence interval */
} filtration_estimate;

/* Remarks about a result. */
#define FILTRATION_REMARKS(X)                                                                                          \
    X(FILTRATION_REMARK_BENT, 1u, "the readings used are not on a straight line: there is no interval")                \
    X(FILTRATION_REMARK_MEDIUM, 2u, "the intercept is negative: clear liquid went first, or the clock began late")     \
    X(FILTRATION_REMARK_SLOPE, 4u, "the slope is not above 0 with the stated confidence: no cake is seen")             \
    X(FILTRATION_REMARK_CORRELATED, 8u, "neighbouring errors are alike: the interval is wider for it")                 \
    X(FILTRATION_REMARK_FEW, 16u,                                                                                      \
      "fewer than 20 readings cannot tell whether neighbouring errors are alike: the interval allows for it")          \
    X(FILTRATION_REMARK_DRIFT, 32u,                                                                                    \
      "the readings bend within the tolerance: the interval allows for a balance that drifts as much")
#define FILTRATION__REMARK(name, bit, text) name = bit,
typedef enum filtration_remark { FILTRATION_REMARKS(FILTRATION__REMARK) FILTRATION_NO_REMARK = 0 } filtration_remark;
FILTRATION_API const char *filtration_remark_text(unsigned remark); /* of one bit; never NULL; static storage */

typedef struct filtration_curve {
    filtration_estimate slope;     /* [s/m6] */
    filtration_estimate intercept; /* [s/m3] */
    filtration_estimate product;   /* r_K K_S [1/m2] */
    filtration_estimate cake;      /* r_K [1/m2]; NaN without K_S */
    filtration_estimate by_mass;   /* alpha = r_K K_S / solids [m/kg]; NaN without the mass of solids */
    filtration_estimate medium;    /* R_M [1/m] */
    double covariance;             /* of slope and intercept [s2/m9] */
    size_t first, last;            /* indices of the first and last reading used */
    size_t used;                   /* readings used */
    double freedom;                /* degrees of freedom [-] */
    double student;                /* factor from standard error to interval, of slope and intercept [-] */
    double scatter;                /* standard deviation of t / V about the line, over its mean [-] */
    double r2;                     /* coefficient of determination [-] */
    double bend;                   /* departure of a fitted parabola and cubic from the line, over the mean t / V [-] */
    double correlation;            /* of neighbouring errors: 0 independent .. 1 they add up [-] */
    unsigned remarks;              /* bits of filtration_remark */
    double pressure, viscosity, area, confidence; /* of the definition */
    double smallest, largest;                     /* filtrate volume of the first and of the last reading used [m3] */
} filtration_curve;

FILTRATION_API filtration_curve_def filtration_curve_default_def(void);
/* Returns BAD_DEF and the name of the first bad field (field may be NULL), or OK and NULL. */
FILTRATION_API filtration_status filtration_curve_check_def(const filtration_curve_def *def, const char **field);
/* Fits (3) to n readings of time [s] and filtrate volume [m3] (arrays of the caller, in the order of time). Readings at
   or before the start are left out. BAD_DEF; BAD_ARGUMENT: a reading is negative, infinite or not a number, time runs
   backwards, or the volume does: after the start it falls below an earlier one by more than 2 % of the largest and six
   volume_error (the vessel was emptied, or this is more than one filtration). Less is scatter, and counts as it was
   read. FEW_DATA: fewer than 3; NO_SOLUTION: all at one volume, or out of the range of doubles. After any of them the
   numbers are NaN, used and remarks 0. With FILTRATION_REMARK_BENT there are values, but error, low and high are NaN: a
   line that is none has no interval. */
FILTRATION_API filtration_status filtration_evaluate(const filtration_curve_def *def, size_t n, const double *time,
                                                     const double *volume, filtration_curve *result);
/* Determines the resistance of the clean medium [1/m]: the mean of dp t A / (mu V) over the readings from the start to
   last_volume [m3] > 0, before there is a cake, at least 2. Errors, and NaN, as above. The caller leaves out readings
   where t / V still rises. */
FILTRATION_API filtration_status filtration_evaluate_clean(const filtration_curve_def *def, size_t n,
                                                           const double *time, const double *volume, double last_volume,
                                                           filtration_estimate *medium);
/* Predicts the time [s] to a filtrate volume V >= 0 [m3] on another filter: pressure [Pa], area [m2] > 0,
   compressibility n of the cake as above (0 for the measured pressure), with the interval that follows from slope and
   intercept. NaN with BAD_ARGUMENT. */
FILTRATION_API filtration_status filtration_predict(const filtration_curve *curve, double pressure, double area,
                                                    double compressibility, double V, filtration_estimate *time);
/* The power law of a compressible cake from runs at several pressures: value = at_reference (p / reference)^exponent,
   where a value is alpha, r_K or r_K K_S. Runs scatter by more than their own errors (no two cakes are alike), and by
   how much is not known: the law is the mean over several weightings, each weighted by its likelihood. Intervals follow
   from the departures from the law, with runs - 2 degrees of freedom. */
typedef struct filtration_compressibility {
    filtration_estimate exponent;     /* n [-] */
    filtration_estimate at_reference; /* of the value, in its unit; interval in logarithms */
    double reference;                 /* pressure difference [Pa] */
    double covariance;                /* of exponent and logarithm of the value at reference [-] */
    double between;                   /* standard deviation between runs beyond their errors, relative [-] */
    double freedom, student, confidence;
    double lowest, highest; /* pressure difference of the runs [Pa] */
    size_t runs;
} filtration_compressibility;
/* Fits the law to runs >= 2 at pressure [Pa] with value > 0 and its relative standard error (arrays of the caller,
   [runs]; error may be NULL: not known; 0 and NaN mean the same for a run). reference > 0 [Pa]; confidence above 0 ..
   below 1. With 2 runs there is a law without intervals (NaN). BAD_ARGUMENT; FEW_DATA: fewer than 2; NO_SOLUTION: all
   at one pressure. Then the numbers are NaN. */
FILTRATION_API filtration_status filtration_fit_compressibility(size_t runs, const double *pressure,
                                                                const double *value, const double *error,
                                                                double reference, double confidence,
                                                                filtration_compressibility *fit);
/* Computes the value at another pressure > 0 [Pa], with its interval. BAD_ARGUMENT: NaN. */
FILTRATION_API filtration_status filtration_value_at_pressure(const filtration_compressibility *fit, double pressure,
                                                              filtration_estimate *value);

/* Which part of a prediction lies outside the readings. */
#define FILTRATION_OUTSIDES(X)                                                                                         \
    X(FILTRATION_OUTSIDE_MORE, 1u, "more filtrate on an area than any reading: a thicker cake")                        \
    X(FILTRATION_OUTSIDE_LESS, 2u, "less filtrate on an area than any reading of the straight stretch")                \
    X(FILTRATION_OUTSIDE_PRESSURE, 4u, "another pressure: the cake's compressibility is not measured")
#define FILTRATION__OUTSIDE(name, bit, text) name = bit,
enum filtration_outside_flag { FILTRATION_OUTSIDES(FILTRATION__OUTSIDE) FILTRATION_OUTSIDE_NOTHING = 0 };
/* Returns the flags of a prediction that leaves the readings by more than 1 %: arguments as above. 0 for NULL. */
FILTRATION_API unsigned filtration_outside(const filtration_curve *curve, double pressure, double area, double V);
FILTRATION_API const char *filtration_outside_text(unsigned flag); /* of one flag; never NULL; static storage */
