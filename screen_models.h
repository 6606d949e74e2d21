/* screen_models.h: how much of each size class is still on a screen: evaluate, step, fit and predict, in batch or along
   a deck.

       #include "screen_models.h"
       #include <stdio.h>
       int main(void) {
           double diameter[2] = {0.005, 0.007}, time[2] = {5.0, 10.0}, retained[4], parameter[SCREEN_MAX_PARAMETERS];
           screen_def def = screen_default_def();              // aperture 8 mm, wire 2 mm, 20 s; SI units everywhere
           screen_operation initial = {0.001, 50.6, 0.0, 0.0}; // amplitude, frequency, moisture, inclination
           def.classes = 2;
           def.diameters = diameter;
           screen_published(SCREEN_SUBASINGHE, parameter);
           screen_status status = screen_predict(&def, SCREEN_SUBASINGHE, parameter, &initial, 2, time, retained, 0, 0);
           printf("%s: %.3f of 5 mm, %.3f of 7 mm after 5 s\n", screen_status_text(status), retained[0], retained[2]);
       }

   Models, each with its parameters (E&K = Elskamp and Kruggel-Emden 2019, whose equation numbers are used; extended
   there by moisture M)
     SCREEN_FIRST_ORDER  0  k alpha gamma: Y = exp(-k t), eq 29
     SCREEN_DONG         1  k alpha gamma [beta delta]: Y = (1 - p Y)^N, eq 25 in two readings; p eq 23, 24; N eq 28, 26
     SCREEN_SUBASINGHE   2  k_s alpha gamma k_p beta delta: stratification, then passage, two first-order steps, eq 31,
                            34, 35
     SCREEN_SOLDINGER    3  k_s alpha gamma k_p beta delta: stratification that slows as fines leave, bottom layer, eq
                            36-43
   Every rate is k x^exponent with x = A f (1-M)^moisture_exponent / (sqrt(d g) size_ratio): screen_rate(). The
   size_ratio is d/a in model 0, 1 in model 1, and d/d_av for k_s, d/a for k_p in models 2 and 3. d: size of the class,
   a: aperture, d_av: mean size. Exponent and moisture_exponent are alpha, gamma for k and k_s, and beta, delta for k_p.
   Beta, delta of model 1 are those of eq 26, for a deck only: screen_attempts_deck().

   What is in it
     >>laws        pure functions of scalars
     >>predict     curves of a case, partition curve, time to a recovery; screen_step() for flowsheet simulators
     >>soldinger   positive, mass-conserving integrator of model 3, adaptive or with a fixed step
     >>fit         bounded multi-start fit by the paper's deviation or by least squares; what the data leave open;
                   profiles
     >>bands       mean, spread and confidence bands of a prediction
     >>separation  d50, imperfection, misplaced fractions
     >>feed        classes from a sieve curve, Rosin-Rammler or lognormal
     >>deck        a steady deck: what stays and passes along it, bed depth, efficiency, capacity

   Units: SI; fractions, not percent; radians. Arrays are [class][time], time fastest.
   Errors: a function that returns a status leaves NaN in its outputs if that is not SCREEN_OK, unless its comment says
   otherwise; laws return NaN outside their domain.
   Memory: only screen_predict of model 3, screen_time_to, screen_fit, screen_profile and screen_band ask for any,
   through the hook def.memory, and give it back before they return.
   Threads: no state outside the arguments; calls on different objects may run at the same time.
   Determinism: same input, same bits, on every machine and build that keeps IEEE arithmetic (-ffp-contract=off); random
   numbers come from a seed.
   What it does not do: motion of single grains (dem.h); how apertures block (blocking.h: its free fraction goes into
   def.free_fraction). Models 0, 1, 2 do not know the load: the same curve for any mass on the deck, unless
   load_exponent says how passage depends on it; nor does model 3 where stratification is instant, as in its published
   set. Model 3 depends on how the feed is cut into classes: two halves of a class pass half as fast. Outside the range
   of a fit the models extrapolate: set def.domain to be told (SCREEN_OUTSIDE).
   Settings: SCREEN_API extern everywhere and SCREEN_IMPLEMENTATION in one file give one compiled copy; default is
   static inline. */
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "screen_models.h needs NaN and signed zero: compile without -ffast-math"
#endif
#ifndef SCREEN_MODELS_H
#define SCREEN_MODELS_H
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#ifndef SCREEN_API
#define SCREEN_API static inline
#define SCREEN__BODIES
#elif defined(SCREEN_IMPLEMENTATION)
#define SCREEN__BODIES
#endif
#ifdef __cplusplus
extern "C" {
#endif

/* ---- status ------------------------------------------------------------------------------------------------------ */

#define SCREEN_STATUSES(X)                                                                                             \
    X(SCREEN_OK, "ok")                                                                                                 \
    X(SCREEN_NO_MEMORY, "out of memory")                                                                               \
    X(SCREEN_BAD_POINTER, "an array that is needed is null")                                                           \
    X(SCREEN_BAD_DEF, "a field of screen_def is out of range: screen_check_def names it")                              \
    X(SCREEN_BAD_MODEL, "no such model, or the model has no form for this deck")                                       \
    X(SCREEN_BAD_OPERATION, "amplitude [m], frequency [Hz] or inclination [rad] out of range")                         \
    X(SCREEN_MOISTURE_IN_PERCENT, "moisture is a mass fraction in [0, 1): this looks like percent")                    \
    X(SCREEN_BAD_MOISTURE, "moisture is a mass fraction in [0, 1)")                                                    \
    X(SCREEN_BAD_PARAMETERS, "a rate constant is not positive or a parameter is not finite")                           \
    X(SCREEN_NOT_FINITE, "these parameters give a rate that is not finite")                                            \
    X(SCREEN_BAD_TIMES, "times are negative, not finite or not strictly rising")                                       \
    X(SCREEN_DATA_NOT_FINITE, "retained data hold a NaN or an infinity")                                               \
    X(SCREEN_DATA_IN_PERCENT, "retained data are fractions in [0, 1]: these look like percent")                        \
    X(SCREEN_DATA_OUT_OF_RANGE, "retained data lie below 0 or above 1")                                                \
    X(SCREEN_DATA_NOT_MONOTONE, "retained data rise with time")                                                        \
    X(SCREEN_TOO_FEW_POINTS, "fewer data points than parameters to fit")                                               \
    X(SCREEN_BAD_BOUNDS, "a bound is NaN, low above high, or a rate constant's bound is not positive and finite")      \
    X(SCREEN_BAD_OPTION, "an option is out of range")                                                                  \
    X(SCREEN_BAD_ARGUMENT, "an argument is out of range")                                                              \
    X(SCREEN_TOO_MANY_STEPS, "the integrator of model 3 needs more than a million steps")                              \
    X(SCREEN_NOT_REACHED, "the wanted value is not reached in the given range")                                        \
    X(SCREEN_OUTSIDE,                                                                                                  \
      "the answer is there, but outside the range that the parameters were fitted in: screen_outside names what")      \
    X(SCREEN_BAD_CURVE,                                                                                                \
      "sizes must rise, the share passing rise with them within 0..1, and some of the feed be below the aperture")     \
    X(SCREEN_LOAD_UNKNOWN, "the model does not know the load (load_exponent 0): no capacity follows from it")

typedef enum screen_status {
#define SCREEN__ENUM(name, text) name,
    SCREEN_STATUSES(SCREEN__ENUM)
#undef SCREEN__ENUM
} screen_status;

/* Returns one sentence; "unknown status" for anything else. Never null. */
SCREEN_API const char *screen_status_text(screen_status status);

/* ---- configuration ----------------------------------------------------------------------------------------------- */

enum { SCREEN_MAX_PARAMETERS = 6 };

typedef enum screen_model {
    SCREEN_FIRST_ORDER, /* 0 */
    SCREEN_DONG,        /* 1 */
    SCREEN_SUBASINGHE,  /* 2 */
    SCREEN_SOLDINGER    /* 3 */
} screen_model;

/* The mean that d_av of eqs 32, 34, 43 is. The paper's n counts undersize classes. */
typedef enum screen_average {
    SCREEN_AVERAGE_UNDERSIZE, /* plain mean of def.diameters (6 mm for 5 and 7 mm); default */
    SCREEN_AVERAGE_ALL,       /* plain mean of def.diameters and def.coarse_diameter (7.33 mm with 10 mm) */
    SCREEN_AVERAGE_GIVEN      /* def.average_diameter */
} screen_average;

/* What the mass ratio m_p,l,i/m_p,l,i,0 of eq 25 is. docs/screen_models.md weighs the two readings: the published
   parameters belong to the second. */
typedef enum screen_ratio {
    SCREEN_RATIO_RETAINED, /* Y itself: Y = (1 - p Y)^N, implicit */
    SCREEN_RATIO_GRAIN     /* mass of one grain over def.ratio_mass: Y = (1 - p ratio)^N; default */
} screen_ratio;

/* The range of the data to which parameters were fitted: lowest and highest. Of a fit: result.domain; of the published
   sets: screen_published_domain(). */
typedef struct screen_domain {
    double amplitude[2], frequency[2], moisture[2], inclination[2]; /* [m] [Hz] [-] [rad] */
    double diameter[2], aperture[2];                                /* [m] */
    double load[2];                                                 /* mass of the feed over deck_area [kg/m2] */
    double time[2];                                                 /* [s], [m] on a deck */
    int classes[2];                                                 /* number of undersize classes */
} screen_domain;

#define SCREEN_OUTSIDES(X)                                                                                             \
    X(SCREEN_OUTSIDE_AMPLITUDE, 1, "amplitude")                                                                        \
    X(SCREEN_OUTSIDE_FREQUENCY, 2, "frequency")                                                                        \
    X(SCREEN_OUTSIDE_MOISTURE, 4, "moisture")                                                                          \
    X(SCREEN_OUTSIDE_INCLINATION, 8, "inclination")                                                                    \
    X(SCREEN_OUTSIDE_DIAMETER, 16, "grain size")                                                                       \
    X(SCREEN_OUTSIDE_APERTURE, 32, "aperture")                                                                         \
    X(SCREEN_OUTSIDE_LOAD, 64, "load of the deck, which the model does not know")                                      \
    X(SCREEN_OUTSIDE_CLASSES, 128, "number of classes, on which model 3 depends")                                      \
    X(SCREEN_OUTSIDE_TIME, 256, "time")
enum screen_outside_flag {
#define SCREEN__ENUM(name, value, text) name = value,
    SCREEN_OUTSIDES(SCREEN__ENUM)
#undef SCREEN__ENUM
        SCREEN_OUTSIDE_NOTHING = 0
};

/* Memory hook, like realloc: fn(user, old, old_size, new_size). new_size 0 frees and returns null; null:
   out of memory. */
typedef struct screen_memory {
    void *(*fn)(void *user, void *old, size_t old_size, size_t new_size); /* null: the C library's realloc and
                                                                             free (default) */
    void *user;
} screen_memory;

/* The deck and its feed. Made by screen_default_def(), which gives the batch screen of E&K section 4, then set classes
   and diameters. */
typedef struct screen_def {
    double aperture; /* a, clear width of a square aperture [m], > 0; 0.008 */
    double wire;     /* w, wire diameter [m], >= 0; 0.002; model 1 */
    double duration; /* t_end of eq 28 [s], > 0; 20; model 1 in batch */
    double gravity;  /* g [m/s2], > 0; 9.81 */
    int continuous;  /* 0 (default): batch, the coordinate is time [s]. 1: deck, the coordinate is length [m] and k_s,
                             k_p are in 1/m; models 0, 1, 2 */
    int classes;     /* undersize classes, >= 1; the default 0 must be set */
    const double *diameters; /* d_i [classes] [m], each in (0, aperture), or up to aperture + worn_by; not owned; the
                                default null must be set */
    const double *shares;    /* S_inf,i = m_i,0/m_0 [classes], mass of a class over the mass of all undersize [-], > 0,
                                sum 1 to 1e-6; not owned; null (default): equal shares */
    screen_average average;  /* SCREEN_AVERAGE_UNDERSIZE; models 2, 3 */
    double average_diameter; /* d_av [m], > 0; 0.006; read with SCREEN_AVERAGE_GIVEN only */
    /* Model 1 only */
    screen_ratio ratio; /* SCREEN_RATIO_GRAIN, the reading of the published parameters */
    double density;     /* of a grain [kg/m3], > 0; 2534.1; read with SCREEN_RATIO_GRAIN only, as the next */
    double ratio_mass;  /* mass that a grain's is measured in [kg], > 0; 0.001: grams, as in the paper's Table 2. k
                           belongs to it */
    /* Model 3 only */
    double undersize_mass;  /* m_0 [kg], > 0; 0.94 */
    double oversize_mass;   /* M_0 (1 - Q_0), what cannot pass [kg], >= 0; 0.47 */
    double coarse_diameter; /* d_av,c of eq 41 and size of the oversize [m], > 0; 0.010 */
    double deck_area;       /* W^2 [m2], > 0; 0.02835, a disc of 0.19 m */
    double bulk_density;    /* rho_b [kg/m3], > 0; 1500 */
    double bottom_limit;    /* B_p = B_mP/m_0, capacity of the bottom layer [-], > 0; infinity (default): no limit */
    double tolerance;       /* error of retained that is allowed in a step of the adaptive integrator [-], [1e-14,
                               1e-2]; 1e-9; the same for the stratified part where it matters to the retained, 1000
                               times that elsewhere */
    double fixed_step;      /* > 0 [s]: steps of this length without error control, stable and positive for any; 0
                               (default): adaptive */
    /* Properties of a plant that the paper's test sieve lacks: all are off by default, in every model and call */
    double dead_time;            /* nothing is counted below before this [s] ([m] on a deck), >= 0; 0 */
    double never_passes;         /* share of every class that never passes [-], [0, 1); 0 */
    int free_points;             /* free fraction of the holes over time: numbers in the next two, >= 0; 0: all
                                    holes are free */
    const double *free_time;     /* [free_points] rising [s] ([m]); straight lines between, constant outside;
                                    not owned; null */
    const double *free_fraction; /* [free_points] [-], [0, 1]; from blocking.h or counted. It slows passage, not
                                    stratification */
    double aperture_ratio;       /* length over width of an opening, >= 1, infinite for rods; 1: square. Width is
                                    aperture; model 1 */
    int project_aperture;        /* 1: an inclined deck counts with the aperture and the wire as projected from above, a
                                    cos(inclination); 0 (default). Model 1 on a deck has eq 23 for that and
                                    does not read it */
    double worn_share;           /* share of the holes that are wider, [0, 1]; 0 */
    double worn_by;        /* by this [m], >= 0; 0. Classes up to aperture + worn_by may then stand in diameters: what
                              wear lets through */
    double load_exponent;  /* rates of passage are multiplied by (load_reference/load)^this, load = all mass over
                              deck_area; >= 0; 0: the load has no influence (but for stratification in model 3); 1:
                              holes per mass of feed decide */
    double load_reference; /* load at which the parameters were fitted [kg/m2], > 0; 49.7, that of the paper; read with
                              an exponent only */
    const screen_domain *domain; /* range of the fit: outside, screen_predict, screen_partition and screen_time_to fill
                                    their outputs and return SCREEN_OUTSIDE; not owned; null (default): not checked */
    screen_memory memory;        /* the C library's */
    uint32_t cookie;             /* set by screen_default_def */
} screen_def;

/* Operation of the deck. All four are checked by every driver. */
typedef struct screen_operation {
    double amplitude;   /* A, half the stroke [m], (0, 0.1] */
    double frequency;   /* f [Hz], (0, 1e4] */
    double moisture;    /* M, liquid mass over particle mass [-], [0, 1) */
    double inclination; /* tau [rad], [0, pi/2); read by model 1 on a continuous deck only, where > 0 is needed */
} screen_operation;

SCREEN_API screen_def screen_default_def(void);

/* Returns SCREEN_OK, or the reason and, where field is not null, the name of the first bad field (a string constant;
   null when ok). */
SCREEN_API screen_status screen_check_def(const screen_def *def, const char **field);
SCREEN_API screen_status screen_check_operation(const screen_operation *operation);

/* Returns the number of parameters of a model: 3 3 6 6, and 5 for model 1 on a continuous deck; 0 for no such model. */
SCREEN_API int screen_parameter_count(screen_model model, int continuous);
/* Returns "k", "alpha", "gamma", ... in the order of the table at the top; null outside it. Rate constants are "k",
   "k_s", "k_p". */
SCREEN_API const char *screen_parameter_name(screen_model model, int index);
/* Copies the set that E&K section 5.3 prints for all 27 cases to parameters[SCREEN_MAX_PARAMETERS], 0 where the model
   has fewer. SCREEN_BAD_MODEL for model 0, which has none there. */
SCREEN_API screen_status screen_published(screen_model model, double *parameters);

/* Returns the domain of the 27 cases to which they were fitted. */
SCREEN_API screen_domain screen_published_domain(void);
/* Returns flags of enum screen_outside_flag for the quantities of a prediction that lie outside a domain, by more than
   1 % of their values; 0 for none or for null pointers. last_time: the largest time of interest [s], or 0. The number
   of classes counts only for model 3, whose curves depend on it. */
SCREEN_API unsigned screen_outside(const screen_domain *domain, const screen_def *def, screen_model model,
                                   const screen_operation *operation, double last_time);
/* Returns the name of one flag; "unknown flag" for anything else. */
SCREEN_API const char *screen_outside_text(unsigned flag);

/* ---- predict ----------------------------------------------------------------------------------------------------- */

/* Curves of one case.
     parameters  [screen_parameter_count]; rate constants > 0 [1/s], or [1/m] on a deck, or [-] (model 1); exponents any
                 finite
     times       [times] rising from >= 0 [s]; lengths [m] on a deck
     retained    out [classes][times] Y, mass still on the screen over initial mass of the class, eq 21 [-]
     stratified  out [classes][times] S/S_inf, what has ever reached the bottom layer (models 0, 1: 1) [-]; may be null
     bottom      out [classes][times] B/S_inf, what lies in the bottom layer now (models 0, 1: Y) [-]; may be null
   Y = bottom + 1 - stratified. Errors: as the statuses. */
SCREEN_API screen_status screen_predict(const screen_def *def, screen_model model, const double *parameters,
                                        const screen_operation *operation, int times, const double *time,
                                        double *retained, double *stratified, double *bottom);

/* Returns the paper's deviation of a case (section 5.3): mean of |model - data| over points = classes x times [-]. NaN
   for points < 1. */
SCREEN_API double screen_deviation(int points, const double *model, const double *data);

/* Computes the partition curve at one time [s] (length [m]): fraction of each diameter that stays, 1 for d >= aperture.
   diameters [n] [m], > 0, any order; partition out [n] [-]. Models 0, 1, 2, whose classes are independent; the classes
   of def matter only through d_av. SCREEN_BAD_MODEL for model 3: its passage depends on how the feed is cut
   into classes. */
SCREEN_API screen_status screen_partition(const screen_def *def, screen_model model, const double *parameters,
                                          const screen_operation *operation, double time, int n,
                                          const double *diameters, double *partition);

/* Finds the time [s] (length [m]) at which the given share of all undersize [-], [0, 1), has passed, to 1e-12 of limit;
   SCREEN_NOT_REACHED if later than limit, which is > 0. */
SCREEN_API screen_status screen_time_to(const screen_def *def, screen_model model, const double *parameters,
                                        const screen_operation *operation, double recovery, double limit, double *time);

/* Scratch of model 3 in a screen_bed: nothing to keep or to set. */
typedef struct screen__layer {
    double log_w, log_factors, layers, b, b_free, volume, scale, decrement, c[3], u[3], y[2], x_of[5], y_of[5], u_next,
        y_next, u_best, y_best;
} screen__layer;

/* One class of a bed that a flowsheet simulator steps. The caller owns an array [classes]; masses [kg] may be changed
   between steps. */
typedef struct screen_bed {
    double fed;    /* given to the deck so far, >= top + bottom; model 1 reads Y = (top + bottom)/fed */
    double top;    /* on the deck, not yet stratified (models 0, 1: stays 0) */
    double bottom; /* on the deck, at the mesh */
    double passed; /* gone through so far */
    double age;    /* since screen_bed_init [s] ([m]); read with a dead_time or a free_fraction only */
    screen__layer own;
} screen_bed;

/* Fills a bed with the batch at t = 0: undersize_mass x share of every class, unstratified. bed [classes]. */
SCREEN_API screen_status screen_bed_init(const screen_def *def, screen_model model, screen_bed *bed);

/* Makes one step of any model with the operation, the parameters and def as they are now.
     feed    [classes] laid on top of the bed at the start of the step [kg], >= 0; null: none
     dt      [s], >= 0 and finite (length [m] on a deck)
     passed  out [classes] mass through the mesh in this step [kg]; may be null
   fed = top + bottom + passed stays true to round-off; a refused step changes no mass. Constant inputs give the closed
   forms whatever the steps. Model 1 continues at the N that belongs to Y = (top + bottom)/fed (on a deck beta < 0 is
   needed: N must rise with the length). Model 3 measures all masses in units of def.undersize_mass. */
SCREEN_API screen_status screen_step(const screen_def *def, screen_model model, const double *parameters,
                                     const screen_operation *operation, double dt, const double *feed, screen_bed *bed,
                                     double *passed);

/* ---- fit --------------------------------------------------------------------------------------------------------- */

/* Measured or simulated curves of one operation. Nothing is owned. */
typedef struct screen_case {
    screen_operation operation;
    int times;              /* >= 1 */
    const double *time;     /* [times] [s], rising, >= 0 */
    const double *retained; /* [classes][times] [-], [0, 1] within the noise; a rise with time is noted in the result */
} screen_case;

/* Where the first bad datum stands; -1 where it does not apply. */
typedef struct screen_where {
    int index; /* case */
    int klass; /* size class */
    int time;
} screen_where;

#define SCREEN_MOST_STARTS 10000
#define SCREEN_MOST_ITERATIONS 100000

/* Returns the half-width, in standard errors, of a range that holds the share `level` of Student's t with dof degrees
   of freedom (whole numbers; others are rounded down), the normal distribution from 1e6 on. level (0, 1), dof >= 1. NaN
   outside. Student 1908. */
SCREEN_API double screen_student(double level, double dof);

typedef enum screen_loss {
    SCREEN_LOSS_DEVIATION, /* mean |model - data|, the paper's; default */
    SCREEN_LOSS_SQUARES    /* mean (model - data)^2 */
} screen_loss;

typedef struct screen_fit_options {
    screen_loss loss;
    int starts;                         /* random starts, 1 .. SCREEN_MOST_STARTS; 20 */
    int iterations;                     /* of one start in all, 1 .. SCREEN_MOST_ITERATIONS; 400 */
    uint64_t seed;                      /* any; 1 */
    const double *start;                /* [parameters] replaces the first random start; not owned; null:
                                           none (default) */
    double low[SCREEN_MAX_PARAMETERS];  /* bounds, as the parameters: rate constants 1e-12 .. 1e12 (> 0), alpha,
                                           beta -50 .. 50, */
    double high[SCREEN_MAX_PARAMETERS]; /* gamma, delta -1000 .. 1000. low = high holds a parameter. */
    double data_error; /* accuracy of the data [-], > 0; 1e-3: a parameter is judged by an error of at least this
                          size */
    double shrink;     /* >= 0 [-]: adds half of this x (exponent/5)^2 and x (exponent x moisture exponent/20)^2 to the
                      deviation (all of it to the mean square), so that few cases do not drive exponents far for a small
                      gain: the fit is the minimum of the sum. 0 (default): the plain minimum; 3e-4 is a mild choice */
    double data_tolerance;   /* rise with time, or excess over 1 or below 0, that is taken for noise [-], >= 0; 0.01.
                              Where the scatter of the curves themselves is larger, 8 times that scatter */
    const screen_def *decks; /* [cases] a deck and a feed for each case (aperture, wire, classes, masses ...): all but
                                the numerics and the memory, which are those of the def given; not owned; null
                                (default): the def given for all */
    const double *class_weights; /* [classes], with decks those of all cases one after the other: how well each class is
                                    known, as 1 / (standard error)^2 in any unit, >= 0, in each case one > 0. A residual
                                    counts with the root of it, in the fit and in all that is said of it. 0: the class
                                    is left out (models 2, 3: not of the feed). Not owned; null (default): all alike */
    uint32_t cookie;
} screen_fit_options;

/* Order and number of the parameters as screen_parameter_name. An "error" of a rate constant is that of its
   natural logarithm. */
typedef struct screen_fit_result {
    screen_model model;
    int parameters;
    double parameter[SCREEN_MAX_PARAMETERS];
    double deviation;                    /* mean over cases of the deviation of a case [-] */
    double rms;                          /* root mean square of model - data [-]; both weighted, where there are
                                            class_weights */
    double error[SCREEN_MAX_PARAMETERS]; /* standard error; infinite: no influence; NaN: at its bound, see its range.
                                            Residuals that correlate with their neighbours count as fewer points */
    double dof;                          /* degrees of freedom of the errors: points that count, less the free
                                            parameters; at least 1 */
    double student;                      /* half-width of the ranges in errors: screen_student(0.95, dof) */
    double low[SCREEN_MAX_PARAMETERS];   /* 95 % range: parameter -+ student errors (a rate constant by a factor), cut
                                            at the bounds; of a moisture exponent, a quotient, by Fieller: from bound
                                            to bound where its exponent may be 0. Errors are those of the model
                                            linearised at the fit. Where few cases carry many parameters (model 2 from
                                            four), the model is nonlinear within the range, which then holds a little
                                            too rarely */
    double high[SCREEN_MAX_PARAMETERS];
    double correlation[SCREEN_MAX_PARAMETERS][SCREEN_MAX_PARAMETERS];
    int determined[SCREEN_MAX_PARAMETERS]; /* 0: the range reaches farther than ln 2 (rate constant) or max(1, |value|)
                                              (exponent) on either side: the data leave it open */
    int at_bound[SCREEN_MAX_PARAMETERS];   /* 1: stands at a bound that is not low = high */
    int undetermined;                      /* number of parameters that are not determined */
    int starts;                            /* made */
    int starts_at_best;                    /* of them ended within 1e-6 of the best sum of loss and price
                                              (options.shrink) */
    long evaluations;                      /* of the curves of all cases */
    screen_where where;                    /* first bad datum when the data are refused; else the largest rise,
                                              -1 without one */
    int rises;                             /* points that exceed an earlier one by more than the tolerance */
    double largest_rise;                   /* [-] */
    double scatter;                        /* of single points about smooth curves, from the data alone [-]; 0 where it
                                              cannot be told */
    double case_error;  /* root mean square error of a case that was not fitted [-], from residuals of whole cases,
                           which contain the model's own error; used by screen_fit_band */
    screen_ratio ratio; /* the reading of eq 25 and the mass that the parameters belong to */
    double ratio_mass;
    screen_domain domain;                      /* of the data */
    double coefficient[SCREEN_MAX_PARAMETERS]; /* ln k + .., exponent, exponent x moisture exponent: what the rates are
                                               linear in; read by */
    double factor[SCREEN_MAX_PARAMETERS][SCREEN_MAX_PARAMETERS]; /* screen_sample: Cholesky factor of the
                                                                    coefficients' covariance */
    double centre[4]; /* mean log speed and log (1 - M) of the data, for each rate; read by screen_sample */
} screen_fit_result;

SCREEN_API screen_fit_options screen_default_fit_options(screen_model model);

/* Checks whether the curves can be fitted, and whether they fall. where (may be null): the first bad datum. tolerance
   as options.data_tolerance, but noise above it is refused; screen_fit takes the scatter of the data for its tolerance
   and only notes rises. */
SCREEN_API screen_status screen_check_cases(const screen_def *def, int cases, const screen_case *data, double tolerance,
                                            screen_where *where);

/* Fits one parameter set to all cases given: bounded Levenberg-Marquardt in the coefficients of the log rates, from
   several random starts, first on a rounded, then on the sharp absolute deviation. Model 2: exchanging the two steps
   gives the same curves, so the data cannot tell which is which; the slower is called stratification, as in the
   published set, unless the bounds forbid it. Parameters without influence (moisture exponents when M is the same in
   all cases, exponents when A f and d are, delta of a deck when the inclination is) are held at 0, or at
   options->start, or the nearest bound; elsewhere only as far as k would leave its bounds. Where M alone differs, the
   data tell alpha x gamma only: alpha is held at 1 then. Every parameter is also tried at its bounds, the others fitted
   again, so that no bound gives a better fit. Curves that rise are accepted; result->rises counts them. options may be
   null (defaults). Errors: as the statuses; result->where is set for bad data, result->parameters is 0 after any. */
SCREEN_API screen_status screen_fit(const screen_def *def, screen_model model, int cases, const screen_case *data,
                                    const screen_fit_options *options, screen_fit_result *result);

/* Finds the profile range of one parameter (index): how far it may move, all others fitted again, before the loss
   (deviation [-] or mean square, with the price of options->shrink) rises by rise > 0; cut at the bounds: from bound to
   bound for one without influence. result is a fit to the same cases with the same options. */
SCREEN_API screen_status screen_profile(const screen_def *def, int cases, const screen_case *data,
                                        const screen_fit_options *options, const screen_fit_result *result, int index,
                                        double rise, double *low, double *high);

/* Draws parameter sets from the normal distribution about a fit: out sets[n][SCREEN_MAX_PARAMETERS]. A direction that
   the data leave open has the spread 2 of a log rate or exponent (20 of a product with a moisture exponent). Bounds of
   options (null: defaults) hold. */
SCREEN_API screen_status screen_sample(const screen_fit_result *result, const screen_fit_options *options,
                                       uint64_t seed, int n, double *sets);

/* Computes the band of a prediction of new data, from parameters drawn from the fit and the error that the model makes
   on whole cases (result.case_error), which a band of the curve alone lacks. def: the deck of the prediction; level (0,
   1), as 0.95. mean, low, high out [classes][times] [-]; each may be null. Draws 200 sets; seed: any. */
SCREEN_API screen_status screen_fit_band(const screen_def *def, const screen_fit_result *result,
                                         const screen_fit_options *options, const screen_operation *operation,
                                         int times, const double *time, double level, uint64_t seed, double *mean,
                                         double *low, double *high);

/* Computes mean, spread and confidence band of a prediction over parameter sets (from screen_sample, from refits, from
   seeds).
     sets     [n][SCREEN_MAX_PARAMETERS], n >= 2; sets that give no finite curve are left out
     times    rising from >= 0 [s] or [m], as in screen_predict
     scatter  spread of single measurements about the model to be added [-], >= 0: result.case_error for new data; 0 for
              the band of the curve alone, which holds too few of them
     seed     any; read with scatter > 0
     level    share of the distribution inside the band, (0, 1), as 0.95
     mean, spread, low, high  out [classes][times] [-]; each may be null */
SCREEN_API screen_status screen_band(const screen_def *def, screen_model model, int n, const double *sets,
                                     const screen_operation *operation, int times, const double *time, double scatter,
                                     uint64_t seed, double level, double *mean, double *spread, double *low,
                                     double *high);

/* ---- separation -------------------------------------------------------------------------------------------------- */

typedef struct screen_separation {
    double d25, d50, d75;       /* sizes of which 25, 50, 75 % stay [m], linear between the points; NaN when not between
                                   two of them. Of a curve that also falls: d50 where it rises through 50 % last, d25
                                   and d75 the next below and above */
    double ecart;               /* probable error (d75 - d25)/2 [m] */
    double imperfection;        /* (d75 - d25)/(2 d50) [-]; 0 is a perfect cut */
    double recovery;            /* undersize passed / undersize fed [-]; NaN without undersize */
    double oversize_loss;       /* oversize passed / oversize fed [-]; NaN without oversize */
    double misplaced_overflow;  /* undersize in what stays / all that stays [-]; NaN when nothing stays */
    double misplaced_underflow; /* oversize in what passes / all that passes [-]; NaN when nothing passes */
    double efficiency;          /* Hancock: recovery - oversize_loss [-] */
    double yield;               /* passed / fed [-] */
} screen_separation;

/* Computes measures of a deck from a partition curve of any model or experiment. diameters [n] rising [m]; feed [n]
   mass of each class (any unit), >= 0, sum > 0; partition [n] fraction that stays, [0, 1]; cut > 0 [m]: classes below
   it are undersize. SCREEN_NOT_REACHED when only the sizes are missing: the rest is valid. */
SCREEN_API screen_status screen_measure(int n, const double *diameters, const double *feed, const double *partition,
                                        double cut, screen_separation *out);

/* Computes the 95 % range of each of these from the standard errors of the measured shares: measured value +- 1.96
   deviations of 1000 drawn sets (normal, cut at 0 and, of the partition, at 1). feed_sd [n] [as feed], >= 0, null: the
   feed is exact; partition_sd [n] [-], >= 0. A field whose value more than 1 in 20 sets do not have is NaN. seed: any;
   memory may be null (the C library's). Statuses as screen_measure; SCREEN_NO_MEMORY. */
SCREEN_API screen_status screen_measure_range(int n, const double *diameters, const double *feed, const double *feed_sd,
                                              const double *partition, const double *partition_sd, double cut,
                                              uint64_t seed, const screen_memory *memory, screen_separation *low,
                                              screen_separation *high);

/* ---- feed -------------------------------------------------------------------------------------------------------- */

/* Returns the mass share finer than d [m] of a Rosin-Rammler (1933) feed, 1 - exp(-(d/d63)^n), and of a lognormal one
   with median d50 and geometric standard deviation sg > 1. d >= 0, d63, d50, n > 0. */
static inline double screen_rosin_rammler(double d, double d63, double n);
static inline double screen_lognormal(double d, double d50, double sg);

/* Divides the undersize of a feed into classes by its sieve curve: equal shares of the mass below the aperture, each
   with its mean size by mass. With this division the mean of the classes, d_av, does not depend on their number, and
   the results of models 0, 1 and 2 converge with it; model 3 depends on it.
     size [points] rising > 0 [m]; passing [points] mass share finer [-], not falling; straight lines between; what lies
     below the first size is taken to lie between 0 and it
     aperture  [m]; diameters [classes] out [m], rising; shares [classes] out, may be null (all are 1/classes);
     undersize: share of the feed below the aperture [-], may be null. SCREEN_BAD_CURVE also where the curve ends below
     the aperture with less than 1. */
SCREEN_API screen_status screen_classes(int points, const double *size, const double *passing, double aperture,
                                        int classes, double *diameters, double *shares, double *undersize);

/* ---- steady deck ------------------------------------------------------------------------------------------------- */

/* A deck that is fed all the time. The bed travels as a plug: a slice of it is a batch of the load feed/(width
   velocity), whose age is the place over the velocity. */
typedef struct screen_duty {
    double feed;     /* all that is fed [kg/s], > 0 */
    double width;    /* [m], > 0 */
    double length;   /* [m], > 0 */
    double velocity; /* of the bed along the deck [m/s], > 0; measured, or from a simulation */
} screen_duty;

typedef struct screen_flow {
    double load, depth;           /* of the bed where it is fed: [kg/m2], and over def.bulk_density [m] */
    double load_end, depth_end;   /* at the end of the deck */
    double residence;             /* length/velocity [s] */
    double passed, stays;         /* [kg/s]; their sum is the feed */
    double efficiency;            /* undersize that passed over undersize fed [-]; undersize: smaller than
                                     def.aperture */
    double purity;                /* undersize in what passes [-]; below 1 with worn holes; NaN if nothing passes */
    double undersize_in_overflow; /* undersize in what stays [-] */
} screen_flow;

/* Computes a steady deck whose feed has the composition of def: its classes with their shares make up undersize_mass,
   oversize_mass cannot pass, and the duty sets the sum of the masses. The time of a model is the age of a slice with
   continuous 0, and its place with 1.
     places    > 0; results stand at length (j + 1)/places
     retained  out [classes][places] mass flow of a class on the deck over that fed [-]: the last column is the
               partition curve
     depth     out [places] of the bed [m]; may be null
     passed    out [classes] through the deck [kg/s]: the feed of a deck below, on which it is taken to fall at its
               head; may be null */
SCREEN_API screen_status screen_steady(const screen_def *def, screen_model model, const double *parameters,
                                       const screen_operation *operation, const screen_duty *duty, int places,
                                       double *retained, double *depth, double *passed, screen_flow *flow);

/* Finds the largest feed [kg/s] at which the deck of a duty (whose feed is not read) reaches an efficiency (0, 1),
   to 1e-9 of it. SCREEN_LOAD_UNKNOWN where passage does not depend on the load; SCREEN_NOT_REACHED where no load
   between 1e-6 and 1e6 kg/m2 does. */
SCREEN_API screen_status screen_capacity(const screen_def *def, screen_model model, const double *parameters,
                                         const screen_operation *operation, const screen_duty *duty, double efficiency,
                                         double *feed);

/* ---- laws: static inline in every mode --------------------------------------------------------------------------- */
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

/* >>laws. NaN outside the domain that each comment gives. */

/* Returns the dimensionless screen velocity x = A f (1-M)^moisture_exponent / (sqrt(d g) size_ratio) raised to
   exponent, times k. It is the rate of every model: size_ratio 1 in eqs 27, 28 (model 1) [-]; d/d_av in eqs 32, 34, 43
   (k_s of models 2, 3) [1/s]; d/aperture in eqs 33, 35, 40 (k_p of models 2, 3, and k of model 0, which has their
   form) [1/s]. def.ratio is another ratio, of masses. k >= 0; amplitude [m], frequency [Hz], d [m], g [m/s2],
   size_ratio > 0; moisture [0, 1); exponents any. Overflow gives infinity. */
static inline double screen_rate(double k, double exponent, double moisture_exponent, double amplitude,
                                 double frequency, double moisture, double d, double size_ratio, double g) {
    if (!(k >= 0.0 && amplitude > 0.0 && frequency > 0.0 && moisture >= 0.0 && moisture < 1.0 && d > 0.0 &&
          size_ratio > 0.0 && g > 0.0))
        return (double)NAN;
    /* one logarithm of each factor: their product may leave the range of a double though the power does not */
    double log_x = riddle_log(amplitude) + riddle_log(frequency) + moisture_exponent * riddle_log1p(-moisture) -
                   0.5 * (riddle_log(d) + riddle_log(g)) - riddle_log(size_ratio);
    return k > 0.0 ? riddle_exp(riddle_log(k) + exponent * log_x) : 0.0;
}

/* Returns the probability to pass in one attempt, eq 23; eq 24 for inclination 0. aperture > 0, wire >= 0, d >= 0 [m],
   inclination [0, pi/2) [rad]. 0 where the grain does not fit, d >= aperture cos(inclination). */
static inline double screen_passage_probability(double aperture, double wire, double d, double inclination) {
    if (!(aperture > 0.0 && wire >= 0.0 && d >= 0.0 && inclination >= 0.0 && inclination < 0.5 * RIDDLE_PI))
        return (double)NAN;
    double c = inclination > 0.0 ? riddle_cos(inclination) : 1.0, pitch = aperture + wire;
    if (!(d < aperture * c)) return 0.0;
    return (aperture - d) / pitch * ((aperture * c - d) / (pitch * c));
}

/* Returns the same for an opening with a given length [m], at least its width, the aperture, which lies across the
   slope; infinite for rods, whose gap alone decides. Eq 23 with another length. */
static inline double screen_slot_probability(double aperture, double length, double wire, double d,
                                             double inclination) {
    if (!(aperture > 0.0 && length >= aperture && wire >= 0.0 && d >= 0.0 && inclination >= 0.0 &&
          inclination < 0.5 * RIDDLE_PI))
        return (double)NAN;
    if (length == aperture) return screen_passage_probability(aperture, wire, d, inclination);
    double c = inclination > 0.0 ? riddle_cos(inclination) : 1.0;
    if (!(d < aperture && d < length * c)) return 0.0;
    return (aperture - d) / (aperture + wire) * (length < HUGE_VAL ? (length * c - d) / ((length + wire) * c) : 1.0);
}

/* Returns the attempts up to time [s] of a batch that lasts duration [s], eq 28; rate from screen_rate with
   size_ratio 1. time >= 0, duration > 0. */
static inline double screen_attempts_batch(double rate, double time, double duration) {
    return rate >= 0.0 && time >= 0.0 && duration > 0.0 ? rate * (time / duration) : (double)NAN;
}

/* Returns the attempts on a deck of the given length [m], eq 26: rate (d/length)^beta inclination^delta. d,
   length > 0 [m], inclination > 0 [rad]. */
static inline double screen_attempts_deck(double rate, double d, double length, double inclination, double beta,
                                          double delta) {
    if (!(rate >= 0.0 && d > 0.0 && length > 0.0 && inclination > 0.0)) return (double)NAN;
    return rate * riddle_exp(beta * riddle_log(d / length) + delta * riddle_log(inclination));
}

/* Returns Y of model 0, eq 29: exp(-k t); k >= 0, t >= 0. */
static inline double screen_first_order(double k, double t) {
    return k >= 0.0 && t >= 0.0 ? riddle_exp(-(k * t)) : (double)NAN;
}

/* Returns Y of a single grain after n attempts, eq 22 and Table 1: (1 - p)^n. This is not model 1 of a bed: see
   screen_dong. p [0, 1], n >=
   0. */
static inline double screen_single_grain(double p, double n) {
    if (!(p >= 0.0 && p <= 1.0 && n >= 0.0)) return (double)NAN;
    return n == 0.0 ? 1.0 : p < 1.0 ? riddle_exp(n * riddle_log1p(-p)) : 0.0;
}

/* Returns Y of model 1, eq 25: the root Y in (0, 1] of Y = (1 - p Y)^n, to 4 ulp. p [0, 1], n >= 0 and finite. With
   s = -ln Y, h(s) = s + n ln(1 - p e^-s) rises and is concave, so it has one root; this lies near Lambert's W(p n)
   for small p. */
static inline double screen_dong(double p, double n) {
    if (!(p >= 0.0 && p <= 1.0 && n >= 0.0 && n < HUGE_VAL)) return (double)NAN;
    double z = p * n;
    if (z == 0.0) return 1.0;
    double l = riddle_log1p(z), s = l * (1.0 - riddle_log1p(l) / (2.0 + l)), low = 0.0, high = HUGE_VAL;
    for (int i = 0; i < 100; i++) {
        /* Y - 1 and Y, each without cancellation. */
        double less = riddle_expm1(-s), y = s < 0.35 ? 1.0 + less : riddle_exp(-s);
        double u = p * y, v = (1.0 - p) - p * less;
        double h = s + n * (u < 0.5 ? riddle_log1p(-u) : riddle_log(v)), slope = 1.0 + n * (u / v),
               bend = -n * (u / (v * v));
        if (h < 0.0) low = s;
        else high = s;
        double next = s - 2.0 * h * slope / (2.0 * slope * slope - h * bend); /* Halley */
        if (!(next >= low && next <= high)) next = high < HUGE_VAL ? 0.5 * (low + high) : s - h / slope;
        double step = next - s;
        s = next;
        if (fabs(step) <= 1e-4 * s) break; /* leaves its cube, which the step below squares */
    }
    double y = riddle_exp(-s), u = p * y, v = 1.0 - u;
    if (!(v > 0.0)) return y;
    /* a last step in Y itself, where logarithms are taken of rounded numbers that both sides share */
    return y - y * ((riddle_log(y) - n * riddle_log1p(-u)) / (1.0 + n * (u / v)));
}

/* Returns the mass of one grain over a reference mass [-], the ratio of eq 25 as its text words it; density [kg/m3],
   d [m], reference [kg], all > 0. */
static inline double screen_grain_ratio(double density, double d, double reference) {
    if (!(density > 0.0 && d > 0.0 && reference > 0.0)) return (double)NAN;
    return density * (RIDDLE_PI / 6.0) * (d * d * d) / reference;
}

/* Returns (1 - e^-z)/z for z >= 0, 1 at 0 */
static inline double screen__expm1c(double z) { return z > 0.0 ? -riddle_expm1(-z) / z : 1.0; }

/* Returns the rounding error of product = a b (Dekker 1971); a, b of 0 .. 1e150. */
static inline double screen__product_error(double a, double b, double product) {
    double a_up = 134217729.0 * a, b_up = 134217729.0 * b, a_high = a_up - (a_up - a), b_high = b_up - (b_up - b);
    double a_low = a - a_high, b_low = b - b_high;
    return ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
}

/* Returns Y of model 2, eqs 30, 31: (k_s e^(-k_p t) - k_p e^(-k_s t))/(k_s - k_p), symmetric in k_s and k_p; (1 + k t)
   e^(-k t) where they are equal. k_s, k_p >= 0 and finite [1/s], t >= 0 and finite [s]; or [1/m] and [m]. */
static inline double screen_subasinghe(double k_s, double k_p, double t) {
    double slow = k_s < k_p ? k_s : k_p, fast = k_s < k_p ? k_p : k_s;
    if (!(slow >= 0.0 && fast < HUGE_VAL && k_s == k_s && k_p == k_p && t >= 0.0 && t < HUGE_VAL)) return (double)NAN;
    double a = slow * t;
    if (!(a <= 745.2)) return 0.0;
    /* an argument rounded by half an ulp of 700 would cost e^-a its last 7 bits */
    double lost = slow < 1e150 && t < 1e150 ? screen__product_error(slow, t, a) : 0.0;
    return riddle_exp(-a) * (1.0 - lost) * (1.0 + a * screen__expm1c((fast - slow) * t));
}

/* Returns the share of model 2 that is not stratified yet, e^(-k_s t) = 1 - S; the bottom layer holds
   screen_subasinghe() minus this. */
static inline double screen_subasinghe_top(double k_s, double t) { return screen_first_order(k_s, t); }

/* Returns the share of fines in the top layer q of model 3, eq 42 [-]; unstratified undersize and
   oversize [kg], >= 0, sum > 0. */
static inline double screen_fines_share(double unstratified, double oversize) {
    return unstratified >= 0.0 && oversize >= 0.0 && unstratified + oversize > 0.0
               ? unstratified / (unstratified + oversize)
               : (double)NAN;
}

/* Returns ln(c_q/w_q) = -(2q)^5 of model 3; q [0, 1]. */
static inline double screen_log_fines_factor(double q) {
    double two_q = 2.0 * q, square = two_q * two_q;
    return q >= 0.0 && q <= 1.0 ? -(square * square * two_q) : (double)NAN;
}

/* Returns ln c_d = -2.5 V/V_av of model 3; volume of a grain of the class and mean volume of grains in the top
   layer, > 0, same unit. */
static inline double screen_log_size_factor(double volume, double mean_volume) {
    return volume > 0.0 && mean_volume > 0.0 ? -2.5 * (volume / mean_volume) : (double)NAN;
}

/* Returns the number of layers of coarse grains in the top layer of model 3, H_t/d_av,c (under eq 41) [-]; mass of the
   top layer [kg], area [m2], density [kg/m3], diameter [m], all > 0. */
static inline double screen_top_layers(double mass, double area, double bulk_density, double coarse_diameter) {
    if (!(mass > 0.0 && area > 0.0 && bulk_density > 0.0 && coarse_diameter > 0.0)) return (double)NAN;
    return mass / (area * bulk_density) / coarse_diameter;
}

/* Returns ln c = ln(c_q c_d/(H_t/d_av,c)) of model 3, eq 41; logarithms, because w_q may be 1e8 and
   more. layers > 0. */
static inline double screen_log_stratification(double log_w, double log_fines_factor, double log_size_factor,
                                               double layers) {
    return layers > 0.0 ? log_w + log_fines_factor + log_size_factor - riddle_log(layers) : (double)NAN;
}

/* Returns the share of the bottom layer that takes part in passage in model 3: min(1, B_p/B), text under eq 39.
   bottom >= 0, limit > 0. */
static inline double screen_bottom_share(double bottom, double limit) {
    return bottom >= 0.0 && limit > 0.0 ? (bottom > limit ? limit / bottom : 1.0) : (double)NAN;
}

/* Returns the passage of model 3, dR/dt = k B share with k = b Y, eqs 39, 40, on the basis of all
   undersize [1/s]; all >= 0. */
static inline double screen_passage(double b, double retained, double bottom, double share) {
    return b >= 0.0 && retained >= 0.0 && bottom >= 0.0 && share >= 0.0 ? b * retained * bottom * share : (double)NAN;
}

/* Returns Y/S_inf = 1/(1 + b S_inf t) of model 3 with instant stratification and no limit of the bottom layer. b,
   s_inf, t >= 0. */
static inline double screen_soldinger_limit(double b, double s_inf, double t) {
    return b >= 0.0 && s_inf >= 0.0 && t >= 0.0 ? 1.0 / (1.0 + b * s_inf * t) : (double)NAN;
}

static inline double screen_rosin_rammler(double d, double d63, double n) {
    if (!(d >= 0.0 && d63 > 0.0 && n > 0.0)) return (double)NAN;
    return d > 0.0 ? -riddle_expm1(-riddle_exp(n * riddle_log(d / d63))) : 0.0;
}

static inline double screen__normal_share(double z) { /* P(|Z| < z): erf's series, all terms positive */
    double term = z, sum = z;
    for (int n = 1; n < 200 && term > 1e-18 * sum; n++) {
        term *= z * z / (2 * n + 1);
        sum += term;
    }
    return sqrt(2.0 / RIDDLE_PI) * riddle_exp(-0.5 * z * z) * sum;
}

static inline double screen_lognormal(double d, double d50, double sg) {
    if (!(d >= 0.0 && d50 > 0.0 && sg > 1.0)) return (double)NAN;
    if (d == 0.0) return 0.0;
    double z = riddle_log(d / d50) / riddle_log(sg), share = fabs(z) < 8.0 ? screen__normal_share(fabs(z)) : 1.0;
    return 0.5 + (z < 0.0 ? -0.5 : 0.5) * share;
}

/* ---- bodies ------------------------------------------------------------------------------------------------------ */
#ifdef SCREEN__BODIES

SCREEN_API const char *screen_status_text(screen_status status) {
    switch (status) {
#define SCREEN__TEXT(name, text)                                                                                       \
    case name: return text;
        SCREEN_STATUSES(SCREEN__TEXT)
#undef SCREEN__TEXT
    }
    return "unknown status";
}

/* >>configuration */
#define SCREEN__DEF_COOKIE 0x73637231u
#define SCREEN__FIT_COOKIE 0x73637232u

/* Numbers in an output [classes][times]; 0 where that cannot be known. */
static inline size_t screen__size(const screen_def *def, int times) {
    return def && def->cookie == SCREEN__DEF_COOKIE && def->classes > 0 && times > 0
               ? (size_t)def->classes * (size_t)times
               : 0;
}

/* Passes a status on; a failure leaves NaN in out [n] (may be null), so that it is not mistaken for a result. */
static inline screen_status screen__leave(screen_status status, size_t n, double *out) {
    for (size_t k = 0; status && status != SCREEN_OUTSIDE && out && k < n; k++) out[k] = (double)NAN;
    return status;
}

SCREEN_API screen_def screen_default_def(void) {
    screen_def def;
    def.aperture = 0.008;
    def.wire = 0.002;
    def.duration = 20.0;
    def.gravity = 9.81;
    def.continuous = 0;
    def.classes = 0;
    def.diameters = NULL;
    def.shares = NULL;
    def.average = SCREEN_AVERAGE_UNDERSIZE;
    def.average_diameter = 0.006;
    def.ratio = SCREEN_RATIO_GRAIN;
    def.density = 2534.1;
    def.ratio_mass = 0.001;
    def.undersize_mass = 0.94;
    def.oversize_mass = 0.47;
    def.coarse_diameter = 0.010;
    def.deck_area = 0.25 * RIDDLE_PI * 0.19 * 0.19;
    def.bulk_density = 1500.0;
    def.bottom_limit = HUGE_VAL;
    def.tolerance = 1e-9;
    def.fixed_step = 0.0;
    def.dead_time = 0.0;
    def.never_passes = 0.0;
    def.free_points = 0;
    def.free_time = def.free_fraction = NULL;
    def.aperture_ratio = 1.0;
    def.project_aperture = 0;
    def.worn_share = 0.0;
    def.worn_by = 0.0;
    def.load_exponent = 0.0;
    def.load_reference = (def.undersize_mass + def.oversize_mass) / def.deck_area;
    def.domain = NULL;
    def.memory.fn = NULL;
    def.memory.user = NULL;
    def.cookie = SCREEN__DEF_COOKIE;
    return def;
}

static inline double screen__clip(double x, double low, double high) { return x < low ? low : x > high ? high : x; }

static inline int screen__positive(double x) { return x > 0.0 && x < HUGE_VAL; }

/* Returns the width of the widest hole [m]: a class below it may pass. */
static inline double screen__widest(const screen_def *def) {
    return def->aperture + (def->worn_share > 0.0 ? def->worn_by : 0.0);
}

static inline const char *screen__bad_option(const screen_def *def) {
    if (!(def->dead_time >= 0.0 && def->dead_time < HUGE_VAL)) return "dead_time";
    if (!(def->never_passes >= 0.0 && def->never_passes < 1.0)) return "never_passes";
    if (def->free_points < 0) return "free_points";
    if (def->free_points > 0 && !def->free_time) return "free_time";
    if (def->free_points > 0 && !def->free_fraction) return "free_fraction";
    for (int i = 0; i < def->free_points; i++) {
        if (!(fabs(def->free_time[i]) < HUGE_VAL) || (i > 0 && !(def->free_time[i] > def->free_time[i - 1])))
            return "free_time";
        if (!(def->free_fraction[i] >= 0.0 && def->free_fraction[i] <= 1.0)) return "free_fraction";
    }
    if (!(def->aperture_ratio >= 1.0)) return "aperture_ratio";
    if (def->project_aperture != 0 && def->project_aperture != 1) return "project_aperture";
    if (!(def->worn_share >= 0.0 && def->worn_share <= 1.0)) return "worn_share";
    if (!(def->worn_by >= 0.0 && def->worn_by < HUGE_VAL)) return "worn_by";
    if (!(def->load_exponent >= 0.0 && def->load_exponent <= 100.0)) return "load_exponent";
    if (!screen__positive(def->load_reference)) return "load_reference";
    return NULL;
}

static inline const char *screen__bad_classes(const screen_def *def) {
    if (def->classes < 1) return "classes";
    if (!def->diameters) return "diameters";
    for (int i = 0; i < def->classes; i++)
        if (!(def->diameters[i] > 0.0 && def->diameters[i] < screen__widest(def))) return "diameters";
    if (!def->shares) return NULL;
    double sum = 0.0;
    for (int i = 0; i < def->classes; i++) {
        if (!screen__positive(def->shares[i])) return "shares";
        sum += def->shares[i];
    }
    return fabs(sum - 1.0) <= 1e-6 ? NULL : "shares";
}

static inline const char *screen__bad_field(const screen_def *def) {
    if (!def) return "def";
    if (def->cookie != SCREEN__DEF_COOKIE) return "cookie";
    if (!screen__positive(def->aperture)) return "aperture";
    if (!(def->wire >= 0.0 && def->wire < HUGE_VAL)) return "wire";
    if (!screen__positive(def->duration)) return "duration";
    if (!screen__positive(def->gravity)) return "gravity";
    if (def->continuous != 0 && def->continuous != 1) return "continuous";
    const char *bad = screen__bad_option(def);
    if (!bad) bad = screen__bad_classes(def);
    if (bad) return bad;
    if (def->average != SCREEN_AVERAGE_UNDERSIZE && def->average != SCREEN_AVERAGE_ALL &&
        def->average != SCREEN_AVERAGE_GIVEN)
        return "average";
    if (!screen__positive(def->average_diameter)) return "average_diameter";
    if (def->ratio != SCREEN_RATIO_RETAINED && def->ratio != SCREEN_RATIO_GRAIN) return "ratio";
    if (!screen__positive(def->density)) return "density";
    if (!screen__positive(def->ratio_mass)) return "ratio_mass";
    if (!screen__positive(def->undersize_mass)) return "undersize_mass";
    if (!(def->oversize_mass >= 0.0 && def->oversize_mass < HUGE_VAL)) return "oversize_mass";
    if (!screen__positive(def->coarse_diameter)) return "coarse_diameter";
    if (!screen__positive(def->deck_area)) return "deck_area";
    if (!screen__positive(def->bulk_density)) return "bulk_density";
    if (!(def->bottom_limit > 0.0)) return "bottom_limit";
    if (!(def->tolerance >= 1e-14 && def->tolerance <= 1e-2)) return "tolerance";
    if (!(def->fixed_step >= 0.0 && def->fixed_step < HUGE_VAL)) return "fixed_step";
    return NULL;
}

SCREEN_API screen_status screen_check_def(const screen_def *def, const char **field) {
    const char *bad = screen__bad_field(def);
    if (field) *field = bad;
    return bad ? SCREEN_BAD_DEF : SCREEN_OK;
}

SCREEN_API screen_status screen_check_operation(const screen_operation *operation) {
    if (!operation) return SCREEN_BAD_POINTER;
    if (!(operation->amplitude > 0.0 && operation->amplitude <= 0.1)) return SCREEN_BAD_OPERATION;
    if (!(operation->frequency > 0.0 && operation->frequency <= 1e4)) return SCREEN_BAD_OPERATION;
    if (!(operation->inclination >= 0.0 && operation->inclination < 0.5 * RIDDLE_PI)) return SCREEN_BAD_OPERATION;
    if (operation->moisture >= 1.0) return SCREEN_MOISTURE_IN_PERCENT;
    if (!(operation->moisture >= 0.0)) return SCREEN_BAD_MOISTURE;
    return SCREEN_OK;
}

SCREEN_API int screen_parameter_count(screen_model model, int continuous) {
    switch (model) {
    case SCREEN_FIRST_ORDER: return 3;
    case SCREEN_DONG: return continuous ? 5 : 3;
    case SCREEN_SUBASINGHE:
    case SCREEN_SOLDINGER: return 6;
    }
    return 0;
}

SCREEN_API const char *screen_parameter_name(screen_model model, int index) {
    if (index < 0 || index >= screen_parameter_count(model, 1)) return NULL;
    int two = model == SCREEN_SUBASINGHE || model == SCREEN_SOLDINGER;
    switch (index) {
    case 0: return two ? "k_s" : "k";
    case 1: return "alpha";
    case 2: return "gamma";
    case 3: return two ? "k_p" : "beta";
    case 4: return two ? "beta" : "delta";
    default: return "delta";
    }
}

static inline int screen__beyond(const double *range, double value) {
    return !(value >= range[0] - 0.01 * fabs(range[0]) && value <= range[1] + 0.01 * fabs(range[1]));
}

static inline double screen__load_of(const screen_def *def) {
    return (def->undersize_mass + def->oversize_mass) / def->deck_area;
}

SCREEN_API unsigned screen_outside(const screen_domain *domain, const screen_def *def, screen_model model,
                                   const screen_operation *operation, double last_time) {
    unsigned flags = 0;
    if (!domain || !def || !operation) return 0;
    if (screen__beyond(domain->amplitude, operation->amplitude)) flags |= SCREEN_OUTSIDE_AMPLITUDE;
    if (screen__beyond(domain->frequency, operation->frequency)) flags |= SCREEN_OUTSIDE_FREQUENCY;
    if (screen__beyond(domain->moisture, operation->moisture)) flags |= SCREEN_OUTSIDE_MOISTURE;
    if (screen__beyond(domain->inclination, operation->inclination)) flags |= SCREEN_OUTSIDE_INCLINATION;
    for (int i = 0; i < def->classes && def->diameters; i++)
        if (screen__beyond(domain->diameter, def->diameters[i])) flags |= SCREEN_OUTSIDE_DIAMETER;
    if (screen__beyond(domain->aperture, def->aperture)) flags |= SCREEN_OUTSIDE_APERTURE;
    if (def->load_exponent == 0.0 && screen__beyond(domain->load, screen__load_of(def))) flags |= SCREEN_OUTSIDE_LOAD;
    if (model == SCREEN_SOLDINGER && !(def->classes >= domain->classes[0] && def->classes <= domain->classes[1]))
        flags |= SCREEN_OUTSIDE_CLASSES;
    if (last_time > domain->time[1] * 1.01) flags |= SCREEN_OUTSIDE_TIME;
    return flags;
}

SCREEN_API const char *screen_outside_text(unsigned flag) {
    switch (flag) {
#define SCREEN__TEXT(name, value, text)                                                                                \
    case value: return text;
        SCREEN_OUTSIDES(SCREEN__TEXT)
#undef SCREEN__TEXT
    }
    return "unknown flag";
}

SCREEN_API screen_domain screen_published_domain(void) {
    screen_domain d;
    screen_def paper = screen_default_def();
    d.amplitude[0] = 0.0008;
    d.amplitude[1] = 0.0012;
    d.frequency[0] = 45.8;
    d.frequency[1] = 55.4;
    d.moisture[0] = 0.0;
    d.moisture[1] = 0.05;
    d.inclination[0] = d.inclination[1] = 0.0;
    d.diameter[0] = 0.005;
    d.diameter[1] = 0.007;
    d.aperture[0] = d.aperture[1] = 0.008;
    d.load[0] = d.load[1] = screen__load_of(&paper);
    d.time[0] = 0.0;
    d.time[1] = 20.0;
    d.classes[0] = d.classes[1] = 2;
    return d;
}

/* Returns SCREEN_OUTSIDE instead of SCREEN_OK if the result is an extrapolation. */
static inline screen_status screen__told(screen_status status, const screen_def *def, screen_model model,
                                         const screen_operation *operation, double last_time) {
    return !status && def->domain && screen_outside(def->domain, def, model, operation, last_time) ? SCREEN_OUTSIDE
                                                                                                   : status;
}

static inline void screen__set(double *out, double a, double b, double c, double d, double e, double f) {
    out[0] = a;
    out[1] = b;
    out[2] = c;
    out[3] = d;
    out[4] = e;
    out[5] = f;
}

SCREEN_API screen_status screen_published(screen_model model, double *parameters) {
    if (!parameters) return SCREEN_BAD_POINTER;
    if (model == SCREEN_DONG) screen__set(parameters, 1142.6444, -0.0193, -161.2886, 0.0, 0.0, 0.0);
    else if (model == SCREEN_SUBASINGHE) screen__set(parameters, 1.3883, 0.8288, 2.2026, 0.0542, -5.5913, 0.4581);
    else if (model == SCREEN_SOLDINGER) screen__set(parameters, 5.3935, -9.3318, 9.6818, 5.0896, 0.7160, 2.4247);
    else return screen__leave(SCREEN_BAD_MODEL, SCREEN_MAX_PARAMETERS, parameters);
    return SCREEN_OK;
}

/* Allocates count elements; count must not be 0. Returns NULL if out of memory. */
static inline void *screen__take(const screen_memory *memory, size_t count, size_t size) {
    if (count > (size_t)-1 / size) return NULL;
    return memory->fn ? memory->fn(memory->user, NULL, 0, count * size) : malloc(count * size);
}

static inline void screen__release(const screen_memory *memory, void *block, size_t count, size_t size) {
    if (!block) return;
    if (memory->fn) memory->fn(memory->user, block, count * size, 0);
    else free(block);
}

static inline double screen__share(const screen_def *def, int i) {
    return def->shares ? def->shares[i] : 1.0 / def->classes;
}

static inline double screen__average(const screen_def *def) {
    if (def->average == SCREEN_AVERAGE_GIVEN) return def->average_diameter;
    double sum = 0.0;
    for (int i = 0; i < def->classes; i++) sum += def->diameters[i];
    return def->average == SCREEN_AVERAGE_ALL ? (sum + def->coarse_diameter) / (def->classes + 1) : sum / def->classes;
}

/* Every rate is log-linear: ln rate = c0 + c1 speed + c2 wet, with c0 = ln k, c1 = exponent, c2 = exponent x moisture
   exponent. On a deck model 1 adds c3 size + c4 slope. One such triple for models 0 and 1, two for 2 and 3. */
typedef struct screen__terms {
    double speed[2], wet, size, slope, d;
} screen__terms;

static inline int screen__rates(screen_model model) {
    return model == SCREEN_SUBASINGHE || model == SCREEN_SOLDINGER ? 2 : 1;
}

static inline screen__terms screen__terms_of(const screen_def *def, screen_model model, double average,
                                             const screen_operation *operation, double d) {
    screen__terms t;
    double log_d = riddle_log(d), dry = riddle_log(operation->amplitude) + riddle_log(operation->frequency) -
                                        0.5 * (log_d + riddle_log(def->gravity));
    double to_aperture = dry - log_d + riddle_log(def->aperture);
    t.speed[0] = model == SCREEN_DONG          ? dry
                 : model == SCREEN_FIRST_ORDER ? to_aperture
                                               : dry - log_d + riddle_log(average);
    t.speed[1] = to_aperture;
    t.wet = riddle_log1p(-operation->moisture);
    t.size = log_d;
    t.d = d;
    t.slope = operation->inclination > 0.0 ? riddle_log(operation->inclination) : 0.0;
    return t;
}

/* Returns ln of the factors of the rate of passage: the load, and the share of the holes that let a class pass, worn
   ones at the rate for their size. In model 1 the holes are part of p. */
static inline double screen__log_holes(const screen_def *def, screen_model model, double exponent, double d) {
    double load =
        def->load_exponent > 0.0 ? def->load_exponent * riddle_log(def->load_reference / screen__load_of(def)) : 0.0;
    if (model == SCREEN_DONG || (def->worn_share == 0.0 && d < def->aperture)) return load;
    double share = d < def->aperture ? 1.0 - def->worn_share : 0.0;
    if (d < screen__widest(def) && def->worn_share > 0.0)
        share += def->worn_share *
                 riddle_exp(screen__clip(exponent * riddle_log(screen__widest(def) / def->aperture), -600.0, 600.0));
    return share > 0.0 ? load + riddle_log(share) : -1e5; /* passes nowhere */
}

/* Computes ln of the rates of a class, [screen__rates]; coefficients [parameters]. */
static inline void screen__log_rates(const screen_def *def, screen_model model, const double *c, const screen__terms *t,
                                     double *log_rate) {
    int last = screen__rates(model) - 1;
    for (int r = 0; r <= last; r++) log_rate[r] = c[3 * r] + c[3 * r + 1] * t->speed[r] + c[3 * r + 2] * t->wet;
    if (model == SCREEN_DONG && def->continuous) log_rate[0] += c[3] * t->size + c[4] * t->slope;
    log_rate[last] += screen__log_holes(def, model, c[3 * last + 1], t->d);
}

/* Returns p of model 1 as the mean over the holes. */
static inline double screen__dong_probability(const screen_def *def, double d, double inclination) {
    double length = def->aperture * def->aperture_ratio, tau = def->continuous ? inclination : 0.0;
    double p = screen_slot_probability(def->aperture, length, def->wire, d, tau);
    if (def->worn_share == 0.0) return p;
    double wire = def->wire > def->worn_by ? def->wire - def->worn_by : 0.0; /* the hole gains what the wire loses */
    return (1.0 - def->worn_share) * p +
           def->worn_share * screen_slot_probability(screen__widest(def), length + def->worn_by, wire, d, tau);
}

/* Returns the deck as projected from above. */
static inline screen_def screen__projected(const screen_def *def, screen_model model,
                                           const screen_operation *operation) {
    screen_def seen = *def;
    if (!def->project_aperture || (model == SCREEN_DONG && def->continuous)) return seen;
    double c = operation->inclination > 0.0 ? riddle_cos(operation->inclination) : 1.0;
    seen.aperture *= c;
    seen.wire *= c;
    seen.worn_by *= c;
    return seen;
}

/* Returns the free fraction of the holes at a time. */
static inline double screen__free_at(const screen_def *def, double t) {
    int n = def->free_points, low = 0, high = n - 1;
    if (n == 0) return 1.0;
    if (!(t > def->free_time[0])) return def->free_fraction[0];
    if (!(t < def->free_time[n - 1])) return def->free_fraction[n - 1];
    while (high - low > 1) {
        int middle = (low + high) / 2;
        *(def->free_time[middle] <= t ? &low : &high) = middle;
    }
    double x = (t - def->free_time[low]) / (def->free_time[high] - def->free_time[low]);
    return def->free_fraction[low] + x * (def->free_fraction[high] - def->free_fraction[low]);
}

/* Returns the integral of the free fraction over a time: as much passes in it as with all holes free for that long. */
static inline double screen__exposure_between(const screen_def *def, double from, double to) {
    double sum = 0.0, at = from;
    if (!(to > from)) return 0.0;
    if (def->free_points == 0) return to - from;
    for (int i = 0; i <= def->free_points && at < to; i++) {
        double end = i < def->free_points && def->free_time[i] < to ? def->free_time[i] : to;
        if (!(end > at)) continue;
        sum += 0.5 * (screen__free_at(def, at) + screen__free_at(def, end)) * (end - at);
        at = end;
    }
    return sum;
}

static inline double screen__exposure(const screen_def *def, double t) {
    return def->dead_time > 0.0 || def->free_points > 0 ? screen__exposure_between(def, def->dead_time, t) : t;
}

/* Returns the mean free fraction from *from to the next point of its curve, or to `to`, in pieces over which it changes
   by 0.02 at most. Moves *from to the end of the piece. */
static inline double screen__next_free(const screen_def *def, double *from, double to) {
    double start = *from, end = to;
    for (int i = 0; i < def->free_points; i++)
        if (def->free_time[i] > start && def->free_time[i] < end) end = def->free_time[i];
    double a = screen__free_at(def, start), b = screen__free_at(def, end), pieces = floor(1.0 + 50.0 * fabs(b - a));
    if (pieces > 1.0) { /* a chord of a straight line, in steps that see it nearly constant */
        double step = (end - start) / pieces;
        end = start + step < end ? start + step : end;
        b = screen__free_at(def, end);
    }
    *from = end;
    return 0.5 * (a + b);
}

static inline screen_status screen__coefficients(const screen_def *def, screen_model model, const double *parameters,
                                                 double *c) {
    int n = screen_parameter_count(model, def->continuous);
    if (!parameters) return SCREEN_BAD_POINTER;
    if (n == 0 || (model == SCREEN_SOLDINGER && def->continuous)) return SCREEN_BAD_MODEL;
    for (int j = 0; j < n; j++)
        if (!(fabs(parameters[j]) < HUGE_VAL)) return SCREEN_BAD_PARAMETERS;
    for (int r = 0; r < screen__rates(model); r++) {
        if (!(parameters[3 * r] > 0.0)) return SCREEN_BAD_PARAMETERS;
        c[3 * r] = riddle_log(parameters[3 * r]);
        c[3 * r + 1] = parameters[3 * r + 1];
        c[3 * r + 2] = parameters[3 * r + 1] * parameters[3 * r + 2];
    }
    if (n == 5) {
        c[3] = parameters[3];
        c[4] = parameters[4];
    }
    return SCREEN_OK;
}

/* Returns whether a rate is a number below e^600, so that no product of two such rates with a time overflows. */
static inline int screen__rate_ok(double log_rate) { return log_rate < 600.0 && log_rate > -1e300; }

static inline screen_status screen__check_call(const screen_def *def, screen_model model, const double *parameters,
                                               const screen_operation *operation, double *c) {
    screen_status status = screen_check_def(def, NULL);
    for (int j = 0; j < SCREEN_MAX_PARAMETERS; j++) c[j] = 0.0; /* not read after a failure, which gcc does not see */
    if (!status) status = screen_check_operation(operation);
    if (!status) status = screen__coefficients(def, model, parameters, c);
    if (!status && model == SCREEN_DONG && def->continuous && !(operation->inclination > 0.0))
        status = SCREEN_BAD_OPERATION;
    return status;
}

static inline screen_status screen__check_times(int times, const double *time) {
    if (times < 1) return SCREEN_BAD_TIMES;
    if (!time) return SCREEN_BAD_POINTER;
    for (int j = 0; j < times; j++)
        if (!(time[j] >= 0.0 && time[j] < HUGE_VAL) || (j > 0 && !(time[j] > time[j - 1]))) return SCREEN_BAD_TIMES;
    return SCREEN_OK;
}

/* >>soldinger
   With U = S_inf - S the top layer is a system of its own, dU/dt = -c(U) U, and of the retained Y = U + B each class
   obeys dY/dt = -b share Y (Y - U): linear in 1/Y. So U decays by an exponential, 1/Y is integrated in closed form,
   both are positive, B = Y - U never is negative, and what has passed is what is missing: nothing is lost at any step
   size. u, y are fractions of m_0. Slot 0 is now, slot 1 the state that a sweep works on, slot 2 the top layer half a
   step ahead of it. */

/* Computes c of every class from the top layer in a slot. SCREEN_NOT_FINITE above e^600 1/s. */
static inline screen_status screen__stratification(const screen_def *def, screen_bed *bed, int slot) {
    double fines = 0.0, grains = 0.0;
    double d_c = def->coarse_diameter, coarse = def->oversize_mass / def->undersize_mass;
    for (int i = 0; i < def->classes; i++) {
        fines += bed[i].own.u[slot];
        grains += bed[i].own.u[slot] / bed[i].own.volume;
    }
    grains += coarse / (d_c * d_c * d_c);
    double mass = fines + coarse, log_fines = 0.0, layers = 1.0;
    if (mass > 0.0) {
        log_fines = screen_log_fines_factor(screen_fines_share(fines, coarse));
        layers = screen_top_layers(mass * def->undersize_mass, def->deck_area, def->bulk_density, d_c);
    }
    for (int i = 0; i < def->classes; i++) {
        screen__layer *own = &bed[i].own;
        double log_size = mass > 0.0 ? screen_log_size_factor(own->volume, mass / grains) : 0.0;
        if (slot == 0) {
            double log_c = mass > 0.0 ? screen_log_stratification(own->log_w, log_fines, log_size, layers) : own->log_w;
            if (!screen__rate_ok(log_c)) return SCREEN_NOT_FINITE;
            own->c[0] = riddle_exp(log_c);
            own->log_factors = log_fines + log_size;
            own->layers = layers;
        } else { /* by its ratio to slot 0, which is near 1 and then costs half as much */
            own->c[slot] =
                own->c[0] * (own->layers / layers) * (1.0 + riddle_expm1(log_fines + log_size - own->log_factors));
            if (!(own->c[slot] < 3.77e260)) return SCREEN_NOT_FINITE;
        }
    }
    return SCREEN_OK;
}

/* Returns e^-z and sets *mean to its mean over 0 .. z, (1 - e^-z)/z; z >= 0, mostly small: there the order of
   evaluation has few dependencies. */
static inline double screen__decay(double z, double *mean) {
    double e = z < 0.35 ? 0.0 : riddle_exp(-z), z2 = z * z, z4 = z2 * z2;
    if (z < 0.0625)
        *mean = ((1.0 - z * 0.5) + z2 * (1.0 / 6 - z * (1.0 / 24))) +
                z4 * (((1.0 / 120 - z * (1.0 / 720)) + z2 * (1.0 / 5040 - z * (1.0 / 40320))) + z4 * (1.0 / 362880));
    else *mean = z < 0.35 ? -riddle__expm1_small(-z) / z : (1.0 - e) / z;
    return z < 0.35 ? 1.0 - z * *mean : e;
}

/* Advances slot 1 by h with the c of slot 2, which belongs to the middle of the step; symmetric in time. */
static inline void screen__positive_step(const screen_def *def, screen_bed *bed, double h) {
    int n = def->classes, limited = def->bottom_limit < HUGE_VAL;
    double before = 1.0, share, bottom = 0.0;
    for (int i = 0; i < n && limited; i++) bottom += bed[i].own.y[1] - bed[i].own.u[1];
    if (limited) before = screen_bottom_share(bottom > 0.0 ? bottom : 0.0, def->bottom_limit);
    share = before;
    /* with a limit the mean share of start and end, which is found by repetition */
    for (int pass = 0; pass < 20; pass++) {
        double after = 0.0;
        for (int i = 0; i < n; i++) {
            screen__layer *own = &bed[i].own;
            double mean, first, e = screen__decay(h * own->c[2], &mean), u = own->u[1] * e;
            double bh = own->b * share * h, m = bh * own->u[1] * mean; /* b times the integral of U */
            double decay = screen__decay(m, &first);
            double second =
                m < 0.1 ? 0.5 - m * (1.0 / 6 -
                                     m * (1.0 / 24 - m * (1.0 / 120 - m * (1.0 / 720 - m * (1.0 / 5040 - m / 40320)))))
                        : (1.0 - first) / m;
            /* 1/Y tends to 1/U, which runs from 1/U(0) to 1/U(h): weights that hold both limits, slow and instant
               stratification */
            double gain = ((first - second) * e + second) * (2.0 / (1.0 + e));
            double y = own->y[1] / (decay + own->y[1] * bh * gain);
            if (y > own->y[1]) y = own->y[1]; /* only rounding can bring it above, or below U */
            own->u_next = u;
            own->y_next = y > u ? y : u;
            after += own->y_next - u;
        }
        double next = limited ? 0.5 * (before + screen_bottom_share(after, def->bottom_limit)) : share;
        if (fabs(next - share) <= 1e-15) break;
        share = next;
    }
    for (int i = 0; i < n; i++) {
        screen__layer *own = &bed[i].own;
        own->decrement += h * own->c[2];
        own->u[1] = own->u_next;
        own->y[1] = own->y_next;
    }
}

/* Makes n steps of length h/n from slot 0, whose c is known, to slot 1, by the midpoint rule of Gragg (1965): slots 1
   and 2 are advanced in turn, each over the other, so that the error is a series in h^2. */
static inline screen_status screen__sweep(const screen_def *def, screen_bed *bed, int n, double h) {
    screen_status status = SCREEN_OK;
    for (int k = 0; k < n && !status; k++) {
        if (k > 0) status = screen__stratification(def, bed, 1);
        for (int i = 0; i < def->classes; i++) {
            screen__layer *own = &bed[i].own;
            if (k == 0) {
                own->decrement = 0.0;
                own->u[1] = own->u[0];
                own->y[1] = own->y[0];
            }
            double ignored;
            own->u[2] = k == 0 ? own->u[0] * screen__decay(0.5 * h / n * own->c[0], &ignored)
                               : own->u[2] * screen__decay(h / n * own->c[1], &ignored);
        }
        if (!status) status = screen__stratification(def, bed, 2);
        if (!status) screen__positive_step(def, bed, h / n);
    }
    return status;
}

/* Joins the rest of top layers with the bottom layer, since B = Y - U. Returns 1 if a step of any length is exact,
   because everything is stratified and the bottom layer holds it. */
static inline int screen__is_stratified(const screen_def *def, screen_bed *bed) {
    double top = 0.0, bottom = 0.0;
    for (int i = 0; i < def->classes; i++) {
        screen__layer *own = &bed[i].own;
        if (own->u[0] < 1e-18 * own->scale) own->u[0] = 0.0;
        top += own->u[0];
        bottom += own->y[0] - own->u[0];
    }
    return top == 0.0 && !(bottom > def->bottom_limit);
}

/* Makes one step of length h without error control. */
static inline screen_status screen__plain_step(const screen_def *def, screen_bed *bed, double h) {
    screen_status status = screen__sweep(def, bed, 1, h);
    for (int i = 0; i < def->classes && !status; i++) {
        bed[i].own.u[0] = bed[i].own.u[1];
        bed[i].own.y[0] = bed[i].own.y[1];
    }
    return status;
}

enum { SCREEN__ORDERS = 5 };

/* Extrapolates the results of 1 to k + 1 steps to order 2 k + 2: the errors in h^2, h^4, .. cancel. Returns the
   difference from the order before, over the scale of a class; infinite for k = 0. */
static inline double screen__extrapolate(screen_bed *bed, int n, int k) {
    const double weight[SCREEN__ORDERS][SCREEN__ORDERS] = {
        {1.0, 0.0, 0.0, 0.0, 0.0},
        {-1.0 / 3, 4.0 / 3, 0.0, 0.0, 0.0},
        {1.0 / 24, -16.0 / 15, 81.0 / 40, 0.0, 0.0},
        {-1.0 / 360, 16.0 / 45, -729.0 / 280, 1024.0 / 315, 0.0},
        {1.0 / 8640, -64.0 / 945, 6561.0 / 4480, -16384.0 / 2835, 390625.0 / 72576}};
    double error = 0.0;
    for (int i = 0; i < n; i++) {
        screen__layer *own = &bed[i].own;
        double x = 0.0, y = 0.0, ignored;
        own->x_of[k] = own->decrement;
        own->y_of[k] = own->y[1];
        for (int m = 0; m <= k; m++) {
            x += weight[k][m] * own->x_of[m];
            y += weight[k][m] * own->y_of[m];
        }
        /* an error of U reaches Y at the rate b until U is gone, at the rate c */
        double reach = own->b < own->c[0] ? own->b / own->c[0] : 1.0;
        double u = x >= 0.0 ? own->u[0] * screen__decay(x, &ignored) : own->u[1];
        double e_u = k > 0 ? fabs(u - own->u_best) * (reach > 1e-3 ? reach : 1e-3) : HUGE_VAL,
               e_y = k > 0 ? fabs(y - own->y_best) : HUGE_VAL;
        if (!(e_u <= error * own->scale)) error = e_u / own->scale;
        if (!(e_y <= error * own->scale)) error = e_y / own->scale;
        own->u_best = u;
        own->y_best = y;
    }
    return error;
}

/* Tries a step of length h with as many orders as the tolerance needs. *ratio: error over tolerance, accepted up to 1.
   *grow: factor by which the next step may be longer. */
static inline screen_status screen__try_step(const screen_def *def, screen_bed *bed, double h, double *ratio,
                                             double *grow) {
    int k = 0;
    *ratio = HUGE_VAL;
    for (; k < SCREEN__ORDERS && !(*ratio <= 1.0); k++) {
        screen_status status = screen__sweep(def, bed, k + 1, h);
        if (status) return status;
        *ratio = screen__extrapolate(bed, def->classes, k) / def->tolerance;
    }
    /* the error went as h^(2k - 1); where orders are left the next step may well be longer */
    double g = *ratio <= 1e-8 ? 10.0 : 0.9 * riddle_exp(riddle_log(*ratio) * (-1.0 / (2 * k - 1)));
    if (k < SCREEN__ORDERS && g < 2.0) g = 2.0;
    *grow = !(g > 0.1) ? 0.1 : g < 10.0 ? g : 10.0;
    return SCREEN_OK;
}

/* Returns the fastest stratification of a class that still has a top layer [1/s]. */
static inline double screen__fastest(const screen_bed *bed, int n) {
    double fastest = 0.0;
    for (int i = 0; i < n; i++)
        if (bed[i].own.u[0] > 0.0 && bed[i].own.c[0] > fastest) fastest = bed[i].own.c[0];
    return fastest;
}

/* Advances slot 0 by a duration. *hint carries the step size from call to call; 0 at first. */
static inline screen_status screen__advance(const screen_def *def, screen_bed *bed, double duration, double *hint) {
    double left = duration, fastest = HUGE_VAL;
    for (long tries = 0; left > 0.0; tries++) {
        if (tries > 1000000) return SCREEN_TOO_MANY_STEPS;
        int exact = screen__is_stratified(def, bed);
        screen_status status = screen__stratification(def, bed, 0);
        if (status) return status;
        if (exact || def->fixed_step > 0.0) {
            double h = !exact && def->fixed_step < left ? def->fixed_step : left;
            status = screen__plain_step(def, bed, h);
            if (status) return status;
            left -= h;
            continue;
        }
        double before = fastest, ratio, grow;
        fastest = screen__fastest(bed, def->classes);
        if (!(*hint > 0.0)) *hint = fastest > 0.0 ? 0.3 / fastest : left;
        else if (fastest > before) *hint *= before / fastest; /* faster rates need a shorter step */
        double h = *hint < left ? *hint : left;
        status = screen__try_step(def, bed, h, &ratio, &grow);
        if (status) return status;
        if (!(h < *hint && ratio <= 1.0 && h * grow < *hint)) *hint = h * grow;
        if (!(ratio <= 1.0)) continue;
        for (int i = 0; i < def->classes; i++) {
            screen__layer *own = &bed[i].own;
            /* Extrapolation must stay in bounds. */
            double u = own->u_best, y = own->y_best <= own->y[0] ? own->y_best : own->y[1];
            own->y[0] = y > u ? y : u;
            own->u[0] = u;
        }
        left = h < left ? left - h : 0.0;
    }
    return SCREEN_OK;
}

/* Slots of model 3 from the bed and the rates of the operation. */
static inline screen_status screen__load(const screen_def *def, double average, const double *c,
                                         const screen_operation *operation, const double *feed, screen_bed *bed) {
    for (int i = 0; i < def->classes; i++) {
        screen__layer *own = &bed[i].own;
        double d = def->diameters[i], log_rate[2];
        screen__terms terms = screen__terms_of(def, SCREEN_SOLDINGER, average, operation, d);
        screen__log_rates(def, SCREEN_SOLDINGER, c, &terms, log_rate);
        if (!screen__rate_ok(log_rate[0]) || !screen__rate_ok(log_rate[1])) return SCREEN_NOT_FINITE;
        own->log_w = log_rate[0];
        own->b = own->b_free = riddle_exp(log_rate[1]);
        own->volume = d * d * d; /* pi/6 cancels */
        own->scale = screen__share(def, i);
        own->u[0] = (bed[i].top + (feed ? feed[i] : 0.0)) / def->undersize_mass;
        own->y[0] = own->u[0] + bed[i].bottom / def->undersize_mass;
    }
    return SCREEN_OK;
}

/* >>predict */

/* Returns Y of model 2, and in slope its derivatives with respect to ln k_s and ln k_p. */
static inline double screen__subasinghe_slopes(double k_s, double k_p, double t, double *slope) {
    double slow = k_s < k_p ? k_s : k_p, fast = k_s < k_p ? k_p : k_s, z = (fast - slow) * t,
           e = riddle_exp(-(slow * t));
    double mean = screen__expm1c(z), by_slow, by_fast; /* e t mean = (e^(-slow t) - e^(-fast t))/(fast - slow) */
    if (z < 1e-3) {
        by_slow = -0.5 + z * (1.0 / 6 - z / 24);
        by_fast = -0.5 + z * (1.0 / 3 - z / 8);
    } else {
        by_slow = (mean - 1.0) / z;
        by_fast = (riddle_exp(-z) - mean) / z;
    }
    double common = slow * fast * t * t * e; /* t may be 0 and e may underflow: then so does this */
    slope[k_s < k_p ? 0 : 1] = common * by_slow;
    slope[k_s < k_p ? 1 : 0] = common * by_fast;
    return slow * t > 745.2 ? 0.0 : e * (1.0 + slow * t * mean);
}

/* Returns Y of a class after n attempts in model 1; *slope (may be null) receives dY/d ln n. NaN where p times the
   grain's ratio exceeds 1. */
static inline double screen__dong_class(const screen_def *def, double d, double p, double n, double *slope) {
    if (def->ratio == SCREEN_RATIO_GRAIN) {
        double pass = p * screen_grain_ratio(def->density, d, def->ratio_mass), y = screen_single_grain(pass, n);
        if (slope) *slope = y > 0.0 ? y * n * riddle_log1p(-pass) : 0.0;
        return y;
    }
    double y = screen_dong(p, n), u = p * y;
    if (slope) *slope = u < 1.0 ? y * n * riddle_log1p(-u) / (1.0 + n * (u / (1.0 - u))) : 0.0;
    return y;
}

/* Attempts after which a class has come to y in (0, 1]. */
static inline double screen__dong_attempts(const screen_def *def, double d, double p, double y) {
    double pass = p * (def->ratio == SCREEN_RATIO_GRAIN ? screen_grain_ratio(def->density, d, def->ratio_mass) : y);
    return y < 1.0 ? riddle_log(y) / riddle_log1p(-pass) : 0.0;
}

/* Advances a class of model 1 by one step from y in (0, 1]. Returns NaN where screen__curves would refuse. */
static inline double screen__dong_step(const screen_def *def, const double *c, const screen_operation *operation,
                                       double d, double rate, double y, double dt) {
    double p = screen__dong_probability(def, d, operation->inclination);
    if (p == 0.0) return y; /* the masses stay */
    double n = screen__dong_attempts(def, d, p, y);
    if (!def->continuous) n += screen_attempts_batch(rate, dt, def->duration);
    /* N grows as length^-beta: find the length that gives the present N, then continue from there. */
    else if (dt > 0.0) {
        double reached = n > 0.0 ? riddle_exp(-riddle_log(n / rate) / c[3]) : 0.0;
        if (!(reached >= HUGE_VAL)) n = rate * riddle_exp(-c[3] * riddle_log(reached + dt));
    }
    return n < HUGE_VAL ? screen__dong_class(def, d, p, n, NULL) : (double)NAN;
}

/* Where a curve goes: [classes][times], the last three may be null. slopes [classes][times][2], models 0 to 2: dY/d ln
   rate, the second of model 1: dY/d beta by length. */
typedef struct screen__out {
    int times;
    const double *time;
    double *retained, *stratified, *bottom, *slopes;
} screen__out;

/* Writes Y and the layers of a class at one time into the output. y: of the share that can pass; the output includes
   the share that never passes. */
static inline void screen__write(const screen_def *def, const screen__out *out, int klass, int j, double y, double top,
                                 const double *slope) {
    size_t at = (size_t)klass * (size_t)out->times + (size_t)j;
    double passes = 1.0 - def->never_passes;
    out->retained[at] = def->never_passes > 0.0 ? def->never_passes + passes * y : y;
    if (out->stratified) out->stratified[at] = 1.0 - top;
    if (out->bottom) out->bottom[at] = out->retained[at] > top ? out->retained[at] - top : 0.0;
    if (!out->slopes || !slope) return;
    out->slopes[2 * at] = passes * slope[0];
    out->slopes[2 * at + 1] = passes * slope[1];
}

/* Sets the bed to the batch at t = 0. */
static inline void screen__fill_bed(const screen_def *def, screen_model model, screen_bed *bed) {
    for (int i = 0; i < def->classes; i++) {
        double mass = def->undersize_mass * screen__share(def, i);
        bed[i].fed = mass;
        bed[i].top = screen__rates(model) == 2 ? mass : 0.0;
        bed[i].bottom = mass - bed[i].top;
        bed[i].passed = bed[i].age = 0.0;
    }
}

/* Computes the curves of model 3; a dead time shifts them. */
static inline screen_status screen__curves_soldinger(const screen_def *def, double average, const double *c,
                                                     const screen_operation *operation, const screen__out *out,
                                                     screen_bed *bed) {
    double now = def->dead_time, hint = 0.0;
    screen__fill_bed(def, SCREEN_SOLDINGER, bed);
    screen_status status = screen__load(def, average, c, operation, NULL, bed);
    for (int j = 0; j < out->times && !status; j++) {
        while (now < out->time[j] && !status) {
            double from = now, end = out->time[j];
            double free_holes = def->free_points > 0 ? screen__next_free(def, &now, end) : 1.0;
            if (def->free_points == 0) now = end;
            for (int i = 0; i < def->classes && def->free_points > 0; i++)
                bed[i].own.b = bed[i].own.b_free * free_holes;
            status = screen__advance(def, bed, now - from, &hint);
        }
        for (int i = 0; i < def->classes && !status; i++) {
            double share = bed[i].own.scale, u = bed[i].own.u[0] / share, y = bed[i].own.y[0] / share;
            if (y > 1.0) y = 1.0; /* only rounding */
            if (u > y) u = y;
            screen__write(def, out, i, j, y, u, NULL);
        }
    }
    return status;
}

/* Computes a curve of model 2 with a varying free fraction: exact over pieces in which it is constant. */
static inline void screen__curve_of_pieces(const screen_def *def, const double *rate, int klass,
                                           const screen__out *out) {
    double now = def->dead_time, top = 1.0, y = 1.0;
    for (int j = 0; j < out->times; j++) {
        while (now < out->time[j]) {
            double from = now, k_p = rate[1] * screen__next_free(def, &now, out->time[j]), h = now - from,
                   at_mesh = y - top;
            y = top * screen_subasinghe(rate[0], k_p, h) + at_mesh * screen_first_order(k_p, h);
            top *= screen_subasinghe_top(rate[0], h);
        }
        screen__write(def, out, klass, j, y, top, NULL);
    }
}

/* Computes the curve of a class in model 1. */
static inline screen_status screen__curve_dong(const screen_def *def, const double *c,
                                               const screen_operation *operation, double rate, int klass,
                                               const screen__out *out) {
    double d = def->diameters[klass], p = screen__dong_probability(def, d, operation->inclination);
    for (int j = 0; j < out->times; j++) {
        double t = screen__exposure(def, out->time[j]), slope[2] = {0.0, 0.0}, n = 0.0;
        double log_length = def->continuous && t > 0.0 ? riddle_log(t) : 0.0;
        if (!def->continuous) n = screen_attempts_batch(rate, t, def->duration);
        else if (t > 0.0) n = rate * riddle_exp(-c[3] * log_length);
        if (!(n < HUGE_VAL)) return SCREEN_NOT_FINITE;
        double y = screen__dong_class(def, d, p, n, out->slopes ? slope : NULL);
        if (!(y >= 0.0)) return SCREEN_NOT_FINITE;
        slope[1] = -log_length * slope[0];
        screen__write(def, out, klass, j, y, 0.0, slope);
    }
    return SCREEN_OK;
}

/* Models 0 and 2 of a class. */
static inline void screen__curve_exponential(const screen_def *def, screen_model model, const double *rate, int klass,
                                             const screen__out *out) {
    for (int j = 0; j < out->times; j++) {
        double t = screen__exposure(def, out->time[j]), slope[2] = {0.0, 0.0}, top = 0.0, y;
        if (model == SCREEN_FIRST_ORDER) {
            y = screen_first_order(rate[0], t);
            slope[0] = -rate[0] * t * y;
        } else {
            y = out->slopes ? screen__subasinghe_slopes(rate[0], rate[1], t, slope)
                            : screen_subasinghe(rate[0], rate[1], t);
            top = out->stratified || out->bottom ? screen_subasinghe_top(rate[0], t) : 0.0;
        }
        screen__write(def, out, klass, j, y, top, slope);
    }
}

/* Curves from coefficients. bed [classes]: model 3 only. */
static inline screen_status screen__curves(const screen_def *flat, screen_model model, const double *c,
                                           const screen_operation *operation, const screen__out *out, screen_bed *bed) {
    const screen_def seen = screen__projected(flat, model, operation), *def = &seen;
    double average = screen__average(def);
    if (model == SCREEN_SOLDINGER) return screen__curves_soldinger(def, average, c, operation, out, bed);
    for (int i = 0; i < def->classes; i++) {
        double log_rate[2], rate[2] = {0.0, 0.0};
        screen__terms terms = screen__terms_of(def, model, average, operation, def->diameters[i]);
        screen__log_rates(def, model, c, &terms, log_rate);
        for (int r = 0; r < screen__rates(model); r++) {
            if (!screen__rate_ok(log_rate[r])) return SCREEN_NOT_FINITE;
            rate[r] = riddle_exp(log_rate[r]);
        }
        screen_status status = SCREEN_OK;
        if (model == SCREEN_DONG) status = screen__curve_dong(def, c, operation, rate[0], i, out);
        else if (model == SCREEN_SUBASINGHE && def->free_points > 0) screen__curve_of_pieces(def, rate, i, out);
        else screen__curve_exponential(def, model, rate, i, out);
        if (status) return status;
    }
    return SCREEN_OK;
}

static inline screen__out screen__out_of(int times, const double *time, double *retained) {
    screen__out out;
    out.times = times;
    out.time = time;
    out.retained = retained;
    out.stratified = out.bottom = out.slopes = NULL;
    return out;
}

SCREEN_API screen_status screen_predict(const screen_def *def, screen_model model, const double *parameters,
                                        const screen_operation *operation, int times, const double *time,
                                        double *retained, double *stratified, double *bottom) {
    double c[SCREEN_MAX_PARAMETERS];
    screen_status status = screen__check_call(def, model, parameters, operation, c);
    if (!status) status = screen__check_times(times, time);
    if (!status && !retained) status = SCREEN_BAD_POINTER;
    screen_bed *bed = NULL;
    size_t n = screen__size(def, 1), points = screen__size(def, times);
    if (!status && model == SCREEN_SOLDINGER) {
        bed = (screen_bed *)screen__take(&def->memory, n, sizeof *bed);
        if (!bed) status = SCREEN_NO_MEMORY;
    }
    if (!status) {
        screen__out out = screen__out_of(times, time, retained);
        out.stratified = stratified;
        out.bottom = bottom;
        status =
            screen__told(screen__curves(def, model, c, operation, &out, bed), def, model, operation, time[times - 1]);
    }
    if (bed) screen__release(&def->memory, bed, n, sizeof *bed);
    screen__leave(status, points, stratified);
    screen__leave(status, points, bottom);
    return screen__leave(status, points, retained);
}

SCREEN_API double screen_deviation(int points, const double *model, const double *data) {
    double sum = 0.0;
    if (points < 1 || !model || !data) return (double)NAN;
    for (int j = 0; j < points; j++) sum += fabs(model[j] - data[j]);
    return sum / points;
}

SCREEN_API screen_status screen_partition(const screen_def *def, screen_model model, const double *parameters,
                                          const screen_operation *operation, double time, int n,
                                          const double *diameters, double *partition) {
    double c[SCREEN_MAX_PARAMETERS];
    screen_status status = screen__check_call(def, model, parameters, operation, c);
    if (!status && model == SCREEN_SOLDINGER) status = SCREEN_BAD_MODEL;
    if (!status && (!diameters || !partition)) status = SCREEN_BAD_POINTER;
    if (!status) status = screen__check_times(1, &time);
    if (!status && n < 1) status = SCREEN_BAD_ARGUMENT;
    for (int i = 0; i < n && !status; i++)
        if (!screen__positive(diameters[i])) status = SCREEN_BAD_ARGUMENT;
    if (status) return screen__leave(status, n > 0 ? (size_t)n : 0, partition);
    int outside = 0;
    screen_def one = *def; /* one class at a time; d_av stays that of the whole feed */
    one.average_diameter = screen__average(def);
    one.average = SCREEN_AVERAGE_GIVEN;
    one.classes = 1;
    one.shares = NULL;
    for (int i = 0; i < n && !status; i++) {
        partition[i] = 1.0;
        if (!(diameters[i] < screen__widest(def))) continue;
        one.diameters = &diameters[i];
        screen__out out = screen__out_of(1, &time, &partition[i]);
        status = screen__curves(&one, model, c, operation, &out, NULL);
        if (def->domain && screen__beyond(def->domain->diameter, diameters[i])) outside = 1;
    }
    if (!status && outside) status = SCREEN_OUTSIDE;
    return screen__leave(screen__told(status, def, model, operation, time), (size_t)n, partition);
}

SCREEN_API screen_status screen_time_to(const screen_def *def, screen_model model, const double *parameters,
                                        const screen_operation *operation, double recovery, double limit,
                                        double *time) {
    double c[SCREEN_MAX_PARAMETERS];
    if (!time) return SCREEN_BAD_POINTER;
    *time = (double)NAN;
    screen_status status = screen__check_call(def, model, parameters, operation, c);
    if (status) return status;
    if (!(recovery >= 0.0 && recovery < 1.0) || !screen__positive(limit)) return SCREEN_BAD_ARGUMENT;
    size_t n = (size_t)def->classes;
    screen_bed *bed = (screen_bed *)screen__take(&def->memory, n, sizeof *bed);
    double *y = (double *)screen__take(&def->memory, n, sizeof *y);
    double low = 0.0, high = limit, at = limit;
    if (!bed || !y) status = SCREEN_NO_MEMORY;
    for (int i = 0; i < 60 && !status && high - low > 1e-12 * limit; i++) {
        double passed = 0.0;
        screen__out out = screen__out_of(1, &at, y);
        status = screen__curves(def, model, c, operation, &out, bed);
        for (int k = 0; k < def->classes; k++) passed += screen__share(def, k) * (1.0 - y[k]);
        if (i == 0 && !status && !(passed >= recovery)) status = SCREEN_NOT_REACHED;
        if (passed >= recovery) high = at;
        else low = at;
        at = 0.5 * (low + high);
    }
    if (!status) *time = recovery > 0.0 ? high : 0.0;
    screen__release(&def->memory, bed, n, sizeof *bed);
    screen__release(&def->memory, y, n, sizeof *y);
    return screen__told(status, def, model, operation, *time == *time ? *time : 0.0);
}

SCREEN_API screen_status screen_bed_init(const screen_def *def, screen_model model, screen_bed *bed) {
    screen_status status = screen_check_def(def, NULL);
    if (!bed) return status ? status : SCREEN_BAD_POINTER;
    for (size_t i = 0; status && i < screen__size(def, 1); i++)
        bed[i].fed = bed[i].top = bed[i].bottom = bed[i].passed = bed[i].age = (double)NAN;
    if (!status) screen__fill_bed(def, model, bed);
    return status;
}

/* The screening time h of one step, after the dead time, and the mean free fraction of the holes in it. */
typedef struct screen__moment {
    double h, free_holes;
} screen__moment;

static inline screen__moment screen__moment_of(const screen_def *def, const screen_bed *bed, double dt) {
    screen__moment m;
    m.h = dt;
    m.free_holes = 1.0;
    if (!(def->dead_time > 0.0 || def->free_points > 0)) return m;
    double end = bed->age + dt, start = bed->age > def->dead_time ? bed->age : def->dead_time;
    m.h = end > start ? end - start : 0.0;
    m.free_holes = m.h > 0.0 ? screen__exposure_between(def, start, end) / m.h : 1.0;
    return m;
}

/* Returns the mass on the deck that the model works on: the share that never passes is left out, and the rest is scaled
   to the full mass. */
static inline double screen__active(const screen_def *def, double on_deck, double fed) {
    if (def->never_passes == 0.0) return on_deck;
    double active = (on_deck - def->never_passes * fed) / (1.0 - def->never_passes);
    return active > 0.0 ? active : 0.0;
}

static inline screen_status screen__check_step(const screen_def *def, screen_model model, const double *c, double dt,
                                               const double *feed, const screen_bed *bed) {
    if (!bed) return SCREEN_BAD_POINTER;
    if (!(dt >= 0.0 && dt < HUGE_VAL)) return SCREEN_BAD_ARGUMENT;
    /* N must rise with the length. */
    if (model == SCREEN_DONG && def->continuous && !(c[3] < 0.0)) return SCREEN_BAD_PARAMETERS;
    int aged = def->dead_time > 0.0 || def->free_points > 0;
    for (int i = 0; i < def->classes; i++) {
        const screen_bed *b = &bed[i];
        if (feed && !(feed[i] >= 0.0 && feed[i] < HUGE_VAL)) return SCREEN_BAD_ARGUMENT;
        if (!(b->top >= 0.0 && b->bottom >= 0.0 && b->passed >= 0.0 && b->fed < HUGE_VAL &&
              b->top + b->bottom <= b->fed * (1.0 + 1e-12)))
            return SCREEN_BAD_ARGUMENT;
        if (aged && !(b->age >= 0.0 && b->age < HUGE_VAL)) return SCREEN_BAD_ARGUMENT;
    }
    return SCREEN_OK;
}

/* Computes the masses of a class on the deck and in its top layer after the step, into own.y[0] and own.u[0]. */
static inline screen_status screen__step_class(const screen_def *def, screen_model model, const double *c,
                                               const screen_operation *operation, double fresh, int i, screen_bed *b) {
    double log_rate[2], rate[2] = {0.0, 0.0}, fed = b->fed + fresh;
    double before = screen__active(def, b->top + b->bottom + fresh, fed),
           top = b->top + (screen__rates(model) == 2 ? fresh : 0.0);
    screen__moment m = screen__moment_of(def, b, b->own.c[0]);
    screen__terms terms = screen__terms_of(def, model, screen__average(def), operation, def->diameters[i]);
    screen__log_rates(def, model, c, &terms, log_rate);
    for (int r = 0; r < screen__rates(model); r++) {
        if (!screen__rate_ok(log_rate[r])) return SCREEN_NOT_FINITE;
        rate[r] = riddle_exp(log_rate[r]);
    }
    b->own.y[0] = before;
    b->own.u[0] = top = top < before ? top : before;
    if (!(before > 0.0)) return SCREEN_OK;
    if (model == SCREEN_FIRST_ORDER) {
        b->own.y[0] = before * screen_first_order(rate[0], m.h * m.free_holes);
    } else if (model == SCREEN_DONG) {
        double y = screen__dong_step(def, c, operation, def->diameters[i], rate[0],
                                     before / fed < 1.0 ? before / fed : 1.0, m.h * m.free_holes);
        if (!(y >= 0.0)) return SCREEN_NOT_FINITE;
        b->own.y[0] = fed * y;
    } else {
        double k_p = rate[1] * m.free_holes;
        b->own.u[0] = top * screen_subasinghe_top(rate[0], m.h);
        b->own.y[0] = top * screen_subasinghe(rate[0], k_p, m.h) + (before - top) * riddle_exp(-k_p * m.h);
    }
    return SCREEN_OK;
}

/* Does the same for model 3, for all classes at once. */
static inline screen_status screen__step_soldinger(const screen_def *def, const double *c,
                                                   const screen_operation *operation, double dt, const double *feed,
                                                   screen_bed *bed) {
    double hint = 0.0;
    screen_status status = screen__load(def, screen__average(def), c, operation, feed, bed);
    for (int i = 0; i < def->classes && !status; i++) {
        double fresh = feed ? feed[i] : 0.0;
        screen__layer *own = &bed[i].own;
        if (def->never_passes == 0.0) continue;
        own->y[0] = screen__active(def, bed[i].top + bed[i].bottom + fresh, bed[i].fed + fresh) / def->undersize_mass;
        if (own->u[0] > own->y[0]) own->u[0] = own->y[0];
    }
    screen__moment m = screen__moment_of(def, bed, dt);
    for (int i = 0; i < def->classes && !status && def->free_points > 0; i++)
        bed[i].own.b = bed[i].own.b_free * m.free_holes;
    if (!status) status = screen__advance(def, bed, m.h, &hint);
    for (int i = 0; i < def->classes && !status; i++) {
        bed[i].own.u[0] *= def->undersize_mass;
        bed[i].own.y[0] *= def->undersize_mass;
    }
    return status;
}

static inline screen_status screen__step(const screen_def *flat, screen_model model, const double *parameters,
                                         const screen_operation *operation, double dt, const double *feed,
                                         screen_bed *bed, double *passed) {
    double c[SCREEN_MAX_PARAMETERS];
    screen_status status = screen__check_call(flat, model, parameters, operation, c);
    if (!status) status = screen__check_step(flat, model, c, dt, feed, bed);
    if (status) return status;
    const screen_def seen = screen__projected(flat, model, operation), *def = &seen;
    /* whatever can fail comes first: a refused step leaves the masses as they were */
    if (model == SCREEN_SOLDINGER) status = screen__step_soldinger(def, c, operation, dt, feed, bed);
    for (int i = 0; i < def->classes && !status && model != SCREEN_SOLDINGER; i++) {
        bed[i].own.c[0] = dt;
        status = screen__step_class(def, model, c, operation, feed ? feed[i] : 0.0, i, &bed[i]);
    }
    if (status) return status;
    for (int i = 0; i < def->classes; i++) {
        screen_bed *b = &bed[i];
        double fresh = feed ? feed[i] : 0.0, before = b->top + b->bottom + fresh, held;
        if (passed) passed[i] = 0.0;
        if (def->dead_time > 0.0 || def->free_points > 0) b->age += dt;
        b->fed += fresh;
        if (screen__rates(model) == 2) b->top += fresh;
        else b->bottom += fresh;
        if (!(before > 0.0)) continue;
        held = def->never_passes * b->fed < before ? def->never_passes * b->fed : before;
        double top = b->own.u[0],
               after = def->never_passes > 0.0 ? held + (1.0 - def->never_passes) * b->own.y[0] : b->own.y[0];
        if (screen__rates(model) == 1) top = 0.0;
        if (!(after <= before)) after = before; /* rounding only */
        if (!(top <= after)) top = after;
        b->top = top;
        b->bottom = after - top;
        b->passed += before - after;
        if (passed) passed[i] = before - after;
    }
    return SCREEN_OK;
}

SCREEN_API screen_status screen_step(const screen_def *def, screen_model model, const double *parameters,
                                     const screen_operation *operation, double dt, const double *feed, screen_bed *bed,
                                     double *passed) {
    return screen__leave(screen__step(def, model, parameters, operation, dt, feed, bed, passed), screen__size(def, 1),
                         passed);
}

/* >>fit
   Coordinates. The rates are log-linear in the coefficients c (screen__terms), taken about the mean of the terms over
   all curves, so that c[0] and c[3] are mean log rates; the bounds are a box in q = ln k, exponent, moisture exponent.
   Steps are made in c, where an exponent passes through 0 without its moisture exponent going through infinity; a
   parameter at its bound is left out and the step made in q. */

typedef double screen__matrix[SCREEN_MAX_PARAMETERS][SCREEN_MAX_PARAMETERS];

typedef struct screen__problem {
    screen_def def; /* for model 3 with a tolerance that suits finite differences */
    screen_model model;
    int parameters, cases, points; /* points: classes x times of the longest case */
    const screen_case *data;
    const screen_def *decks; /* [cases] or null */
    const double *weights;   /* of the classes, or null */
    screen_loss loss;
    double shrink;
    double low[SCREEN_MAX_PARAMETERS], high[SCREEN_MAX_PARAMETERS];         /* in q; equal where a parameter is held */
    double box_low[SCREEN_MAX_PARAMETERS], box_high[SCREEN_MAX_PARAMETERS]; /* the caller's, of those without
                                                                               influence too */
    int idle[SCREEN_MAX_PARAMETERS];                                        /* 1: without influence but that of k */
    double home[SCREEN_MAX_PARAMETERS];                                     /* where such a one is held */
    double slope;                                                           /* of all cases, if delta of a
                                                                               deck is idle */
    double centre[4];                                                       /* mean of speed[r] and wet,
                                                                               for each rate */
    double width[4];                                                        /* and how far each reaches
                                                                               from low to high */
    double *retained, *slopes;                                              /* [points], [parameters][points]
                                                                               or [points][2] */
    screen_bed *bed;                                                        /* [most], model 3 */
    int most;                                                               /* classes of a case, at most */
    long evaluations;
    int last_steps; /* 1: down to rounding */
} screen__problem;

/* Returns the deck of a case. */
static inline screen_def screen__deck_of(const screen__problem *p, int index) {
    if (!p->decks) return p->def;
    screen_def deck = p->decks[index];
    deck.tolerance = p->def.tolerance;
    deck.fixed_step = p->def.fixed_step;
    deck.memory = p->def.memory;
    return deck;
}

static inline uint64_t screen__random(uint64_t *state) { /* splitmix64, Steele, Lea and Flood 2014 */
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

static inline double screen__uniform(uint64_t *state) {
    return (double)(screen__random(state) >> 11) * (1.0 / 9007199254740992.0);
}

static inline double screen__normal(uint64_t *state) {
    double u = screen__uniform(state), v = screen__uniform(state);
    return sqrt(-2.0 * riddle_log(1.0 - u)) * riddle_cos(2.0 * RIDDLE_PI * v);
}

static inline int screen__is_rate(screen_model model, int j) { return j == 0 || (j == 3 && screen__rates(model) == 2); }
static inline int screen__is_wet(screen_model model, int j) { return j == 2 || (j == 5 && screen__rates(model) == 2); }

static inline void screen__to_coefficients(screen_model model, int n, const double *centre, const double *q,
                                           double *c) {
    for (int j = 0; j < n; j++) c[j] = q[j];
    for (int r = 0; r < screen__rates(model); r++) {
        c[3 * r + 2] = q[3 * r + 1] * q[3 * r + 2];
        c[3 * r] = q[3 * r] + c[3 * r + 1] * centre[2 * r] + c[3 * r + 2] * centre[2 * r + 1];
    }
}

/* Finds the q inside the bounds nearest to c that keeps the mean log rates where possible. */
static inline void screen__to_box(screen_model model, int n, const double *centre, const double *low,
                                  const double *high, const double *c, double *q) {
    for (int j = 0; j < n; j++) q[j] = screen__clip(c[j], low[j], high[j]);
    for (int r = 0; r < screen__rates(model); r++) {
        int k = 3 * r;
        double gamma = fabs(c[k + 1]) > 1e-300 ? c[k + 2] / c[k + 1] : 0.0; /* of the free exponent, before it is cut */
        q[k + 2] = screen__clip(gamma, low[k + 2], high[k + 2]);
        q[k] = screen__clip(c[k] - q[k + 1] * (centre[2 * r] + q[k + 2] * centre[2 * r + 1]), low[k], high[k]);
    }
}

/* Coefficients about 0, as screen__log_rates takes them. */
static inline void screen__uncentre(screen_model model, int n, const double *centre, const double *c, double *out) {
    for (int j = 0; j < n; j++) out[j] = c[j];
    for (int r = 0; r < screen__rates(model); r++)
        out[3 * r] -= c[3 * r + 1] * centre[2 * r] + c[3 * r + 2] * centre[2 * r + 1];
}

/* Computes the derivatives of log_rate[r] of a class with respect to c: f[2][parameters]. The second row is for model 1
   on a deck: the derivative of beta, which multiplies -ln length. */
static inline void screen__features(const screen__problem *p, const screen__terms *t,
                                    double f[2][SCREEN_MAX_PARAMETERS]) {
    for (int j = 0; j < p->parameters; j++) f[0][j] = f[1][j] = 0.0;
    for (int r = 0; r < screen__rates(p->model); r++) {
        f[r][3 * r] = 1.0;
        f[r][3 * r + 1] = t->speed[r] - p->centre[2 * r];
        f[r][3 * r + 2] = t->wet - p->centre[2 * r + 1];
    }
    if (p->parameters == 5) {
        f[0][3] = t->size;
        f[0][4] = t->slope;
        f[1][3] = 1.0;
    }
}

typedef struct screen__sums {
    double loss, deviation, squares; /* means over cases */
    double gradient[SCREEN_MAX_PARAMETERS];
    screen__matrix curvature; /* Gauss-Newton, by c */
} screen__sums;

/* Returns whether derivatives come from differences of curves: those of model 3 always; those of model 2 with a free
   fraction that changes, and of worn meshes. */
static inline int screen__is_numeric(const screen_def *deck, screen_model model) {
    return model == SCREEN_SOLDINGER || (model == SCREEN_SUBASINGHE && deck->free_points > 0) || deck->worn_share > 0.0;
}

/* Curves of a case at c, into p->retained, and with derivatives dY/dc into p->slopes: [parameters][points
   of the case]. */
static inline screen_status screen__numeric_slopes(screen__problem *p, const screen_def *deck, const screen_case *data,
                                                   const double *c) {
    int n = p->parameters, times = data->times, points = deck->classes * times;
    double plain[SCREEN_MAX_PARAMETERS], average = screen__average(deck);
    /* with no limit of the bottom layer a class of model 3 feels only its own b: one run with all of them
       moved is enough */
    int runs = p->model == SCREEN_SOLDINGER && !(deck->bottom_limit < HUGE_VAL) && deck->worn_share == 0.0 ? 4 : n;
    for (int j = 0; j < runs; j++) {
        double moved[SCREEN_MAX_PARAMETERS] = {0.0},
               step = p->model != SCREEN_SOLDINGER || deck->tolerance < 1e-7 ? 1e-4 : 1e-3;
        if (j % 3) step *= 10.0; /* speed terms are about 0.1, wet 0.03 */
        double *column = p->slopes + (size_t)j * (size_t)p->points;
        for (int k = 0; k < n; k++) moved[k] = c[k];
        moved[j] += step;
        screen__uncentre(p->model, n, p->centre, moved, plain);
        screen__out out = screen__out_of(times, data->time, column);
        screen_status status = screen__curves(deck, p->model, plain, &data->operation, &out, p->bed);
        if (status) return status;
        for (int k = 0; k < points; k++) column[k] = (column[k] - p->retained[k]) / step;
    }
    for (int i = 0; i < deck->classes && runs == 4 && n == 6; i++) {
        double f[2][SCREEN_MAX_PARAMETERS];
        screen__terms terms = screen__terms_of(deck, p->model, average, &data->operation, deck->diameters[i]);
        screen__features(p, &terms, f);
        for (int j = 4; j < 6; j++)
            for (int k = i * times; k < (i + 1) * times; k++)
                p->slopes[(size_t)j * (size_t)p->points + (size_t)k] =
                    f[1][j] * p->slopes[3 * (size_t)p->points + (size_t)k];
    }
    return SCREEN_OK;
}

/* Returns the contribution of a point to the loss; *pull: the weight of its residual in the curvature, and of its gain
   in the gradient. */
static inline double screen__point_loss(const screen__problem *p, double r, double rounding, int weigh, double *pull) {
    *pull = 1.0;
    if (p->loss == SCREEN_LOSS_SQUARES) return 0.5 * r * r;
    double round = sqrt(r * r + rounding * rounding);
    if (weigh) *pull = 1.0 / round;
    return r * r / (round + rounding);
}

/* Weights of the classes of one case: their mean is 1 over those that count. */
typedef struct screen__classes {
    const double *weights; /* or null */
    double count, scale;
} screen__classes;

static inline screen__classes screen__classes_of(const screen_def *def, const screen_def *decks, const double *weights,
                                                 int s) {
    screen__classes of;
    const int n = decks ? decks[s].classes : def->classes;
    double sum = 0.0;
    of.weights = weights;
    of.count = n;
    of.scale = 1.0;
    if (!weights) return of;
    for (int k = 0; decks && k < s; k++) of.weights += decks[k].classes;
    of.count = 0.0;
    for (int i = 0; i < n; i++) sum += of.weights[i], of.count += of.weights[i] > 0.0;
    of.scale = of.count / sum;
    return of;
}

/* Returns what a residual of class i is multiplied by; 0: the class does not count. */
static inline double screen__root(const screen__classes *of, int i) {
    return of->weights ? sqrt(of->weights[i] * of->scale) : 1.0;
}

/* Sums of one class of a case, derivatives from p->slopes: by c, or by the two rates, which become c once the
   curve is done. */
typedef struct screen__call {
    double rounding, weight, root; /* root: of the weight of the class */
    int derivatives, weigh, numeric;
} screen__call;

static inline void screen__add_class(const screen__problem *p, const screen_def *deck, const screen_case *data, int i,
                                     screen__call call, screen__sums *out) {
    double sum[2] = {0.0, 0.0}, product[2][2] = {{0.0, 0.0}, {0.0, 0.0}}, pull;
    int n = p->parameters;
    for (int k = i * data->times; k < (i + 1) * data->times; k++) {
        double r = call.root * (p->retained[k] - data->retained[k]);
        out->deviation += call.weight * fabs(r);
        out->squares += call.weight * r * r;
        out->loss += call.weight * screen__point_loss(p, r, call.rounding, call.weigh, &pull);
        if (!call.derivatives) continue;
        double gain = call.weight * pull * r * call.root, bend = call.weight * pull * call.root * call.root;
        if (call.numeric) {
            for (int a = 0; a < n; a++) {
                double j_a = p->slopes[(size_t)a * (size_t)p->points + (size_t)k];
                out->gradient[a] += gain * j_a;
                for (int b = 0; b <= a; b++)
                    out->curvature[a][b] += bend * j_a * p->slopes[(size_t)b * (size_t)p->points + (size_t)k];
            }
        } else {
            double j0 = p->slopes[2 * k], j1 = p->slopes[2 * k + 1];
            sum[0] += gain * j0;
            sum[1] += gain * j1;
            product[0][0] += bend * j0 * j0;
            product[0][1] += bend * j0 * j1;
            product[1][1] += bend * j1 * j1;
        }
    }
    if (!call.derivatives || call.numeric) return;
    double f[2][SCREEN_MAX_PARAMETERS];
    screen__terms terms = screen__terms_of(deck, p->model, screen__average(deck), &data->operation, deck->diameters[i]);
    screen__features(p, &terms, f);
    for (int a = 0; a < n; a++) {
        out->gradient[a] += sum[0] * f[0][a] + sum[1] * f[1][a];
        for (int b = 0; b <= a; b++)
            out->curvature[a][b] += product[0][0] * f[0][a] * f[0][b] + product[1][1] * f[1][a] * f[1][b] +
                                    product[0][1] * (f[0][a] * f[1][b] + f[1][a] * f[0][b]);
    }
}

/* Returns the second derivative of the penalty on large exponents by c[a]. */
static inline double screen__pull(const screen__problem *p, int a) {
    return screen__is_rate(p->model, a) ? 0.0 : screen__is_wet(p->model, a) ? p->shrink / 400.0 : p->shrink / 25.0;
}

/* Returns that penalty. */
static inline double screen__penalty(const screen__problem *p, const double *c) {
    double sum = 0.0;
    for (int a = 0; a < p->parameters; a++) sum += 0.5 * screen__pull(p, a) * c[a] * c[a];
    return sum;
}

/* Returns its part in what is to be smallest: twice beside the mean square, since descents take half of the square. */
static inline double screen__price(const screen__problem *p, const double *c) {
    return (p->loss == SCREEN_LOSS_SQUARES ? 2.0 : 1.0) * screen__penalty(p, c);
}

/* Adds the penalty, and completes the upper half of the curvature. */
static inline void screen__add_shrink(const screen__problem *p, const double *c, screen__sums *out) {
    int n = p->parameters;
    for (int a = 0; a < n; a++) {
        double pull = screen__pull(p, a);
        out->loss += 0.5 * pull * c[a] * c[a];
        out->gradient[a] += pull * c[a];
        out->curvature[a][a] += pull;
        for (int b = a + 1; b < n; b++) out->curvature[a][b] = out->curvature[b][a];
    }
}

/* Loss at c: rounding > 0 makes |r| smooth, sqrt(r^2 + rounding^2) - rounding. weigh 0: curvature of the squares, for
   the errors. HUGE_VAL where the curves are not finite. */
static inline void screen__evaluate(screen__problem *p, const double *c, double rounding, int derivatives, int weigh,
                                    screen__sums *out) {
    int n = p->parameters;
    double plain[SCREEN_MAX_PARAMETERS];
    out->loss = out->deviation = out->squares = 0.0;
    for (int j = 0; j < n; j++) {
        out->gradient[j] = 0.0;
        for (int k = 0; k < n; k++) out->curvature[j][k] = 0.0;
    }
    p->evaluations++;
    screen__uncentre(p->model, n, p->centre, c, plain);
    for (int s = 0; s < p->cases; s++) {
        const screen_case *data = &p->data[s];
        const screen_def deck = screen__deck_of(p, s);
        screen__call call;
        call.rounding = rounding;
        const screen__classes classes = screen__classes_of(&p->def, p->decks, p->weights, s);
        call.weight = 1.0 / ((double)p->cases * classes.count * data->times);
        call.derivatives = derivatives;
        call.weigh = weigh;
        call.numeric = screen__is_numeric(&deck, p->model);
        screen__out curve = screen__out_of(data->times, data->time, p->retained);
        if (derivatives && !call.numeric) curve.slopes = p->slopes;
        screen_status status = screen__curves(&deck, p->model, plain, &data->operation, &curve, p->bed);
        if (!status && derivatives && call.numeric) status = screen__numeric_slopes(p, &deck, data, c);
        if (status) {
            out->loss = out->deviation = out->squares = HUGE_VAL;
            return;
        }
        for (int i = 0; i < deck.classes; i++) {
            call.root = screen__root(&classes, i);
            if (call.root > 0.0) screen__add_class(p, &deck, data, i, call, out);
        }
    }
    screen__add_shrink(p, c, out);
}

/* Computes the lower Cholesky factor of a symmetric matrix in place. Returns 0 if the matrix is not
   positive definite. */
static inline int screen__cholesky(int n, screen__matrix a) {
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            double s = a[i][j];
            for (int k = 0; k < j; k++) s -= a[i][k] * a[j][k];
            if (i == j && !(s > 0.0)) return 0;
            a[i][j] = i == j ? sqrt(s) : s / a[j][j];
        }
    return 1;
}

static inline void screen__solve(int n, screen__matrix l, double *x) { /* L L^T x = x */
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < i; k++) x[i] -= l[i][k] * x[k];
        x[i] /= l[i][i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) x[i] -= l[k][i] * x[k];
        x[i] /= l[i][i];
    }
}

/* Computes dc/dq at q, [parameters][parameters]. */
static inline void screen__jacobian(const screen__problem *p, const double *q, screen__matrix t) {
    int n = p->parameters;
    for (int a = 0; a < n; a++)
        for (int b = 0; b < n; b++) t[a][b] = a == b ? 1.0 : 0.0;
    for (int r = 0; r < screen__rates(p->model); r++) {
        int k = 3 * r;
        t[k + 2][k + 1] = q[k + 2];
        t[k + 2][k + 2] = q[k + 1];
        t[k][k + 1] = p->centre[2 * r] + q[k + 2] * p->centre[2 * r + 1];
        t[k][k + 2] = q[k + 1] * p->centre[2 * r + 1];
    }
}

/* Computes a = T^T a T and g = T^T g. */
static inline void screen__by_q(int n, screen__matrix t, screen__matrix a, double *g) {
    screen__matrix half;
    double old[SCREEN_MAX_PARAMETERS];
    for (int i = 0; i < n; i++) {
        old[i] = g[i];
        for (int j = 0; j < n; j++) {
            half[i][j] = 0.0;
            for (int k = 0; k < n; k++) half[i][j] += a[i][k] * t[k][j];
        }
    }
    for (int i = 0; i < n; i++) {
        g[i] = 0.0;
        for (int k = 0; k < n; k++) g[i] += t[k][i] * old[k];
        for (int j = 0; j < n; j++) {
            a[i][j] = 0.0;
            for (int k = 0; k < n; k++) a[i][j] += t[k][i] * half[k][j];
        }
    }
}

/* A descent on its way: the loss and its derivatives at q (c in coefficients), and the model of the loss that the next
   step minimises: slopes and curvature, by q where a bound holds a parameter, else by c. */
typedef struct screen__descent {
    double q[SCREEN_MAX_PARAMETERS], c[SCREEN_MAX_PARAMETERS];
    double rounding, damping, enough; /* enough: a gain below this share of the loss counts as none */
    int quiet;                        /* steps in a row without a gain */
    screen__sums now;
    double slope[SCREEN_MAX_PARAMETERS];
    screen__matrix curvature;
    int held[SCREEN_MAX_PARAMETERS], any_held;
} screen__descent;

/* Moves to q, c, where the sums have been evaluated. */
static inline void screen__move(const screen__problem *p, screen__descent *d, const double *q, const double *c,
                                const screen__sums *sums) {
    for (int i = 0; i < p->parameters; i++) {
        d->q[i] = q[i];
        d->c[i] = c[i];
    }
    d->now = *sums;
}

/* Fills slope, curvature and held for the next step. */
static inline void screen__model_loss(const screen__problem *p, screen__descent *d) {
    int n = p->parameters;
    screen__matrix t, by_c;
    double slope_c[SCREEN_MAX_PARAMETERS];
    screen__jacobian(p, d->q, t);
    for (int i = 0; i < n; i++) {
        d->slope[i] = slope_c[i] = d->now.gradient[i];
        for (int j = 0; j < n; j++) d->curvature[i][j] = by_c[i][j] = d->now.curvature[i][j];
    }
    screen__by_q(n, t, d->curvature, d->slope);
    d->any_held = 0;
    for (int i = 0; i < n; i++) {
        d->held[i] = p->low[i] >= p->high[i] || (d->q[i] <= p->low[i] && d->slope[i] > 0.0) ||
                     (d->q[i] >= p->high[i] && d->slope[i] < 0.0);
        d->any_held += d->held[i];
    }
    if (d->any_held) return;
    for (int i = 0; i < n; i++) {
        d->slope[i] = slope_c[i];
        for (int j = 0; j < n; j++) d->curvature[i][j] = by_c[i][j];
    }
}

/* Tries the other sign of an exponent, with the same product, where the bound of its moisture exponent stops it on its
   way through 0. */
static inline int screen__cross_zero(screen__problem *p, screen__descent *d) {
    double across[SCREEN_MAX_PARAMETERS] = {0}, trial[SCREEN_MAX_PARAMETERS];
    screen__sums there;
    for (int k = 0; k < 3 * screen__rates(p->model) && d->any_held; k += 3) {
        if (!(d->held[k + 2] && p->low[k + 2] < p->high[k + 2] && d->q[k + 1] * d->now.gradient[k + 1] > 0.0)) continue;
        for (int i = 0; i < p->parameters; i++) across[i] = i == k + 1 ? -d->c[i] : d->c[i];
        screen__to_box(p->model, p->parameters, p->centre, p->low, p->high, across, trial);
        screen__to_coefficients(p->model, p->parameters, p->centre, trial, across);
        screen__evaluate(p, across, d->rounding, 1, 1, &there);
        if (!(there.loss < d->now.loss)) continue;
        screen__move(p, d, trial, across, &there);
        return 1;
    }
    return 0;
}

/* Finds the minimum of the damped model, cut to the bounds: trial, and the same as coefficients. Returns 0 if the
   model has none. */
static inline int screen__damped_minimum(const screen__problem *p, const screen__descent *d, double *trial,
                                         double *trial_c) {
    int n = p->parameters;
    double biggest = 0.0, step[SCREEN_MAX_PARAMETERS];
    screen__matrix l;
    for (int i = 0; i < n; i++) biggest = d->curvature[i][i] > biggest ? d->curvature[i][i] : biggest;
    for (int i = 0; i < n; i++) {
        step[i] = d->held[i] ? 0.0 : -d->slope[i];
        for (int j = 0; j < n; j++) l[i][j] = d->held[i] || d->held[j] ? 0.0 : d->curvature[i][j];
        l[i][i] = d->held[i] ? 1.0 : d->curvature[i][i] * (1.0 + d->damping) + 1e-10 * d->damping * biggest + 1e-300;
    }
    if (!screen__cholesky(n, l)) return 0;
    screen__solve(n, l, step);
    /* a long jump may end where a rate is so high that nothing depends on it: no way back */
    for (int i = 0; i < n; i++) {
        double longest = screen__is_wet(p->model, i) ? 40.0 : 2.0;
        step[i] = screen__clip(step[i], -longest, longest);
    }
    if (d->any_held)
        for (int i = 0; i < n; i++) trial[i] = screen__clip(d->q[i] + step[i], p->low[i], p->high[i]);
    else {
        for (int i = 0; i < n; i++) step[i] += d->c[i];
        screen__to_box(p->model, n, p->centre, p->low, p->high, step, trial);
    }
    screen__to_coefficients(p->model, n, p->centre, trial, trial_c);
    return 1;
}

/* Makes one step downhill, damped until the loss falls. Returns 0 if it cannot fall any more. */
static inline int screen__step_down(screen__problem *p, screen__descent *d) {
    const int with = p->model != SCREEN_SOLDINGER; /* whose derivatives cost seven curves: only where a step is taken */
    double trial[SCREEN_MAX_PARAMETERS], trial_c[SCREEN_MAX_PARAMETERS];
    screen__sums next;
    for (; d->damping < 1e12; d->damping = d->damping < 1e-8 ? 1e-6 : 8.0 * d->damping) {
        if (!screen__damped_minimum(p, d, trial, trial_c)) continue;
        screen__evaluate(p, trial_c, d->rounding, with, 1, &next);
        if (!(next.loss < d->now.loss)) continue;
        d->quiet = d->now.loss - next.loss <= d->enough * d->now.loss && d->damping < 1.0 ? d->quiet + 1 : 0;
        if (!with) screen__evaluate(p, trial_c, d->rounding, 1, 1, &next);
        screen__move(p, d, trial, trial_c, &next);
        d->damping = d->damping > 1e-11 ? 0.1 * d->damping : 1e-12;
        return 1;
    }
    return 0;
}

/* Minimises the rounded loss by the Levenberg-Marquardt method from q (inside the bounds); uses up to
   *left iterations. */
static inline double screen__descend(screen__problem *p, double *q, double rounding, int most, int *left) {
    screen__descent d;
    d.rounding = rounding;
    d.damping = 1e-3;
    d.quiet = 0;
    /* the rounded losses are but a way to the sharp one */
    d.enough = p->last_steps ? 1e-12 : p->loss == SCREEN_LOSS_SQUARES || rounding < 1e-5 ? 1e-7 : 1e-4;
    for (int i = 0; i < p->parameters; i++) d.q[i] = q[i];
    screen__to_coefficients(p->model, p->parameters, p->centre, d.q, d.c);
    screen__evaluate(p, d.c, rounding, 1, 1, &d.now);
    if (!(d.now.loss < HUGE_VAL)) return HUGE_VAL;
    for (int it = 0; it < most && 0 < *left && d.quiet < 2; it++, --*left) {
        screen__model_loss(p, &d);
        if (d.any_held == p->parameters || (!screen__cross_zero(p, &d) && !screen__step_down(p, &d))) break;
    }
    for (int i = 0; i < p->parameters; i++) q[i] = d.q[i];
    return d.now.loss;
}

SCREEN_API screen_fit_options screen_default_fit_options(screen_model model) {
    screen_fit_options options;
    options.loss = SCREEN_LOSS_DEVIATION;
    options.starts = 20;
    options.iterations = 400;
    options.seed = 1;
    options.start = NULL;
    for (int j = 0; j < SCREEN_MAX_PARAMETERS; j++) {
        double width = screen__is_wet(model, j) ? 1000.0 : 50.0;
        options.low[j] = screen__is_rate(model, j) ? 1e-12 : -width;
        options.high[j] = screen__is_rate(model, j) ? 1e12 : width;
    }
    options.data_error = 1e-3;
    options.shrink = 0.0;
    options.data_tolerance = 0.01;
    options.decks = NULL;
    options.class_weights = NULL;
    options.cookie = SCREEN__FIT_COOKIE;
    return options;
}

/* Returns the distance of a point y, which lies w of the way from a to b in time, from the straight line between them,
   or with decay from the exponential where there is one; over the standard deviation that unit scatter gives it. */
static inline double screen__off(double y, double a, double b, double w, int decay) {
    double from = 1.0 - w, to = w, between = from * a + to * b;
    if (decay && a > 0.0 && b > 0.0) {
        between = riddle_exp(from * riddle_log(a) + to * riddle_log(b));
        from *= between / a, to *= between / b;
    }
    return fabs(y - between) / sqrt(1.0 + from * from + to * to);
}

/* Returns the scatter of single points: the median of their distances from what their neighbours in time say, over all
   curves with three points or more; 0 without such. It is found by bisection, so nothing is stored. */
static inline double screen__scatter_about(const screen_def *def, const screen_fit_options *options, int cases,
                                           const screen_case *data, int decay) {
    const screen_def *decks = options->decks;
    double low = 0.0, high = 2.0;
    for (int it = 0; it < 40; it++) {
        double middle = 0.5 * (low + high), below = 0.0, all = 0.0;
        for (int s = 0; s < cases; s++) {
            const screen__classes of = screen__classes_of(def, decks, options->class_weights, s);
            int classes = decks ? decks[s].classes : def->classes, times = data[s].times;
            for (int i = 0; i < classes; i++)
                for (int j = 1; j + 1 < times && screen__root(&of, i) > 0.0; j++) {
                    const double *y = data[s].retained + (size_t)i * (size_t)times + (size_t)j, *t = data[s].time + j;
                    const double w = (t[0] - t[-1]) / (t[1] - t[-1]);
                    all += 1.0;
                    below += screen__off(y[0], y[-1], y[1], w, decay) <= middle;
                }
        }
        if (!(all > 0.0)) return 0.0;
        if (below < 0.5 * all) low = middle;
        else high = middle;
    }
    return high < 1e-9 ? 0.0 : high / 0.6744897501960817; /* median of a normal distribution's absolute values */
}

/* What a curve bends between points that are far apart, as at times that double, is no scatter: the smaller of two. */
static inline double screen__scatter(const screen_def *def, const screen_fit_options *options, int cases,
                                     const screen_case *data) {
    const double line = screen__scatter_about(def, options, cases, data, 0),
                 decay = screen__scatter_about(def, options, cases, data, 1);
    return line < decay ? line : decay;
}

/* Checks the numbers of one case. rises (may be null): rises are noted there and not refused. */
static inline screen_status screen__check_case(const screen_def *deck, const screen_case *data, double tolerance,
                                               screen_where *where, screen_fit_result *rises) {
    screen_status status = screen_check_operation(&data->operation);
    if (status) return status;
    if (data->times < 1) return SCREEN_TOO_FEW_POINTS;
    if (!data->time || !data->retained) return SCREEN_BAD_POINTER;
    for (int j = 0; j < data->times; j++) {
        where->time = j;
        if (!(data->time[j] >= 0.0 && data->time[j] < HUGE_VAL)) return SCREEN_BAD_TIMES;
        if (j > 0 && !(data->time[j] > data->time[j - 1])) return SCREEN_BAD_TIMES;
    }
    for (int i = 0; i < deck->classes; i++) {
        double lowest = HUGE_VAL;
        where->klass = i;
        for (int j = 0; j < data->times; j++) {
            double y = data->retained[(size_t)i * (size_t)data->times + (size_t)j];
            where->time = j;
            if (!(fabs(y) < HUGE_VAL)) return SCREEN_DATA_NOT_FINITE;
            if (y > 1.0 + tolerance && y > 1.5 && y <= 100.0 + tolerance) return SCREEN_DATA_IN_PERCENT;
            if (y < -tolerance || y > 1.0 + tolerance) return SCREEN_DATA_OUT_OF_RANGE;
            if (y > lowest + tolerance && !rises) return SCREEN_DATA_NOT_MONOTONE;
            if (y > lowest + tolerance) {
                rises->rises++;
                if (y - lowest > rises->largest_rise) {
                    rises->largest_rise = y - lowest;
                    rises->where = *where;
                }
            }
            if (y < lowest) lowest = y;
        }
    }
    return SCREEN_OK;
}

SCREEN_API screen_status screen_check_cases(const screen_def *def, int cases, const screen_case *data, double tolerance,
                                            screen_where *where) {
    screen_where ignored;
    if (!where) where = &ignored;
    where->index = where->klass = where->time = -1;
    screen_status status = screen_check_def(def, NULL);
    if (status) return status;
    if (cases < 1 || !data) return cases < 1 ? SCREEN_TOO_FEW_POINTS : SCREEN_BAD_POINTER;
    if (!(tolerance >= 0.0 && tolerance < HUGE_VAL)) return SCREEN_BAD_OPTION;
    for (int s = 0; s < cases; s++) {
        where->index = s;
        status = screen__check_case(def, &data[s], tolerance, where, NULL);
        if (status) return status;
        where->klass = where->time = -1;
    }
    where->index = -1;
    return SCREEN_OK;
}

/* Checks the data of a fit, each case with its deck; rises are noted in *out. */
/* Checks the weights of one case and leads on to those of the next: the same again without decks. */
static inline screen_status screen__check_weights(const double **weights, int classes) {
    double sum = 0.0;
    for (int i = 0; i < classes; i++) {
        if (!((*weights)[i] >= 0.0)) return SCREEN_BAD_OPTION;
        sum += (*weights)[i];
    }
    *weights += classes;
    return screen__positive(sum) && sum < 1e300 && sum > 1e-300 ? SCREEN_OK : SCREEN_BAD_OPTION;
}

static inline screen_status screen__check_data(const screen_def *def, int cases, const screen_case *data,
                                               const screen_fit_options *options, screen_fit_result *out) {
    screen_where where;
    where.index = where.klass = where.time = -1;
    if (cases < 1 || !data) return cases < 1 ? SCREEN_TOO_FEW_POINTS : SCREEN_BAD_POINTER;
    if (!(options->data_tolerance >= 0.0 && options->data_tolerance < HUGE_VAL)) return SCREEN_BAD_OPTION;
    double tolerance = HUGE_VAL; /* first the pointers and the times, then the scatter, then the values */
    for (int pass = 0; pass < 2; pass++) {
        const double *weights = options->class_weights;
        for (int s = 0; s < cases; s++) {
            const screen_def *deck = options->decks ? &options->decks[s] : def;
            where.index = s;
            screen_status status = options->decks ? screen_check_def(deck, NULL) : SCREEN_OK;
            if (!status && deck->continuous != def->continuous) status = SCREEN_BAD_DEF;
            if (!options->decks) weights = options->class_weights;
            if (!status && weights) status = screen__check_weights(&weights, deck->classes);
            if (!status) status = screen__check_case(deck, &data[s], tolerance, &where, pass ? out : NULL);
            if (status) {
                out->where = where;
                return status;
            }
            where.klass = where.time = -1;
        }
        if (pass) break;
        out->scatter = screen__scatter(def, options, cases, data);
        tolerance = 8.0 * out->scatter > options->data_tolerance ? 8.0 * out->scatter : options->data_tolerance;
    }
    return SCREEN_OK;
}

static inline double screen__to_q(screen_model model, int j, double value) {
    return screen__is_rate(model, j) ? riddle_log(value) : value;
}

static inline void screen__widen(double *range, double x, int first) {
    range[0] = first || x < range[0] ? x : range[0];
    range[1] = first || x > range[1] ? x : range[1];
}

/* Means and ranges of the terms of all curves: centre [4], range [rate][speed or wet][low, high], slope [low, high]. */
static inline void screen__survey(screen__problem *p, double range[2][2][2], double *slope) {
    int terms = 0;
    p->points = p->most = 0;
    for (int k = 0; k < 4; k++) p->centre[k] = 0.0;
    for (int s = 0; s < p->cases; s++) {
        const screen_def flat = screen__deck_of(p, s), deck = screen__projected(&flat, p->model, &p->data[s].operation);
        int points = deck.classes * p->data[s].times;
        p->points = points > p->points ? points : p->points;
        p->most = deck.classes > p->most ? deck.classes : p->most;
        const screen__classes classes = screen__classes_of(&p->def, p->decks, p->weights, s);
        for (int i = 0; i < deck.classes; i++) {
            if (!(screen__root(&classes, i) > 0.0)) continue;
            screen__terms t =
                screen__terms_of(&deck, p->model, screen__average(&deck), &p->data[s].operation, deck.diameters[i]);
            for (int r = 0; r < 2; r++) {
                screen__widen(range[r][0], t.speed[r], terms == 0);
                screen__widen(range[r][1], t.wet, terms == 0);
                p->centre[2 * r] += t.speed[r];
                p->centre[2 * r + 1] += t.wet;
            }
            screen__widen(slope, t.slope, terms == 0);
            terms++;
        }
    }
    for (int k = 0; k < 4; k++) p->centre[k] /= terms, p->width[k] = range[k / 2][k % 2][1] - range[k / 2][k % 2][0];
}

/* Holds each parameter without influence at its value in q. */
static inline void screen__pin_idle(screen__problem *p, const double *q) {
    for (int j = 0; j < p->parameters; j++)
        if (p->idle[j]) p->low[j] = p->high[j] = q[j];
}

/* Finds out which parameters have no influence but that of k, and where they are held: at options->start, or 0. With
   moisture alone an exponent shows in its product with the moisture exponent only; it is held at 1 then, so that the
   other is free. */
static inline void screen__find_idle(screen__problem *p, const screen_fit_options *options, double range[2][2][2],
                                     const double *slope) {
    p->slope = slope[0];
    for (int j = 0; j < p->parameters; j++) {
        const int r = j / 3, exponent = j % 3;
        const double *low = &options->low[j], *high = &options->high[j];
        double home = options->start ? options->start[j] : 0.0;
        p->idle[j] = 0;
        if (p->parameters == 5 && r == 1) p->idle[j] = j == 4 && slope[1] - slope[0] < 1e-12;
        else if (exponent == 1 && range[r][0][1] - range[r][0][0] < 1e-12) {
            const int wet = range[r][1][1] - range[r][1][0] >= 1e-12 && !(low[1] == 0.0 && high[1] == 0.0);
            p->idle[j] = !(wet && low[1] == high[1]); /* else the product has a known factor */
            if (wet && screen__clip(home, *low, *high) == 0.0) home = *high > 0.0 ? 1.0 : -1.0;
        } else if (exponent == 2)
            p->idle[j] = range[r][1][1] - range[r][1][0] < 1e-12 || (low[-1] == 0.0 && high[-1] == 0.0);
        p->idle[j] = p->idle[j] && *low < *high;
        p->home[j] = screen__clip(home, *low, *high);
    }
    screen__pin_idle(p, p->home);
}

/* Sets bounds, centre and arrays of a problem whose cases have been checked. */
static inline screen_status screen__pose(screen__problem *p, const screen_def *def, screen_model model, int cases,
                                         const screen_case *data, const screen_fit_options *options) {
    int n = screen_parameter_count(model, def->continuous);
    double range[2][2][2] = {{{0.0, 0.0}, {0.0, 0.0}}, {{0.0, 0.0}, {0.0, 0.0}}}, slope[2] = {0.0, 0.0};
    p->def = *def;
    /* while searching; the last steps are made with the caller's */
    if (p->def.tolerance < 1e-6) p->def.tolerance = 1e-6;
    p->model = model;
    p->parameters = n;
    p->cases = cases;
    p->data = data;
    p->decks = options->decks;
    p->weights = options->class_weights;
    p->loss = options->loss;
    p->shrink = options->shrink;
    p->evaluations = 0;
    p->last_steps = 0;
    p->retained = p->slopes = NULL;
    p->bed = NULL;
    screen__survey(p, range, slope);
    for (int j = 0; j < n; j++) {
        double a = options->low[j], b = options->high[j];
        if (!(a <= b) || (screen__is_rate(model, j) && !(a > 0.0 && b < HUGE_VAL))) return SCREEN_BAD_BOUNDS;
        p->low[j] = screen__to_q(model, j, a);
        p->high[j] = screen__to_q(model, j, b);
        p->box_low[j] = p->low[j];
        p->box_high[j] = p->high[j];
    }
    screen__find_idle(p, options, range, slope);
    p->retained = (double *)screen__take(&def->memory, (size_t)p->points, sizeof(double));
    p->slopes = (double *)screen__take(&def->memory, (size_t)p->points * SCREEN_MAX_PARAMETERS, sizeof(double));
    p->bed = (screen_bed *)screen__take(&def->memory, (size_t)p->most, sizeof(screen_bed));
    return p->retained && p->slopes && p->bed ? SCREEN_OK : SCREEN_NO_MEMORY;
}

static inline void screen__dispose(screen__problem *p) {
    screen__release(&p->def.memory, p->retained, (size_t)p->points, sizeof(double));
    screen__release(&p->def.memory, p->slopes, (size_t)p->points * SCREEN_MAX_PARAMETERS, sizeof(double));
    screen__release(&p->def.memory, p->bed, (size_t)p->most, sizeof(screen_bed));
}

/* Draws a random start: mean rates such that passage takes place within the time of the data, exponents of
   either sign. */
static inline void screen__random_start(const screen__problem *p, double last_time, uint64_t *state, double *q) {
    double c[SCREEN_MAX_PARAMETERS];
    int n = p->parameters;
    for (int j = 0; j < n; j++) {
        double u = screen__uniform(state);
        if (screen__is_wet(p->model, j)) c[j] = 40.0 * (u - 0.5);
        else if (!screen__is_rate(p->model, j)) c[j] = 12.0 * (u - 0.5);
        else if (p->model == SCREEN_DONG) c[j] = 3.0 + 7.0 * u; /* attempts: 20 .. 22000 */
        else c[j] = riddle_log(1.0 / last_time) + 7.0 * u - (p->model == SCREEN_SOLDINGER && j == 0 ? 1.0 : 0.0);
    }
    if (n == 5) { /* c[0] is not centred by size, slope and length there */
        c[3] = -1.0 - screen__uniform(state);
        c[4] = screen__uniform(state) - 0.5;
        c[0] += c[3] * (riddle_log(last_time) - riddle_log(p->def.diameters[0]));
    }
    screen__to_box(p->model, n, p->centre, p->low, p->high, c, q);
}

/* Models 2 and 3 have minima where the wrong step limits, or one is so fast that its exponents hardly matter. Once more
   from there: model 2 with the faster step only e^2 times faster than the other and without exponents, model 3 with its
   two steps exchanged. The better of the two stays in q. */
static inline double screen__second_try(screen__problem *p, double *q, double loss, double rounding, int *left) {
    double c[SCREEN_MAX_PARAMETERS], other[SCREEN_MAX_PARAMETERS];
    screen__to_coefficients(p->model, p->parameters, p->centre, q, c);
    int fast = c[0] > c[3] ? 0 : 3;
    for (int j = 0; j < 6 && p->model == SCREEN_SOLDINGER; j++) other[j] = c[(j + 3) % 6];
    for (int j = 0; j < 6 && p->model == SCREEN_SOLDINGER; j++) c[j] = other[j];
    if (p->model == SCREEN_SUBASINGHE) {
        c[fast] = c[3 - fast] + 2.0;
        c[fast + 1] = c[fast + 2] = 0.0;
    }
    screen__to_box(p->model, p->parameters, p->centre, p->low, p->high, c, other);
    double again = screen__descend(p, other, rounding, p->model == SCREEN_SOLDINGER ? 40 : 150, left);
    if (!(again < loss)) return loss;
    for (int j = 0; j < p->parameters; j++) q[j] = other[j];
    return again;
}

/* Takes c for q if it lies inside the bounds, or is cut to them, without making the deviation or the penalty worse. */
static inline int screen__prefer(screen__problem *p, const double *c, double *q) {
    double trial[SCREEN_MAX_PARAMETERS], old[SCREEN_MAX_PARAMETERS], cut[SCREEN_MAX_PARAMETERS];
    screen__sums before, after;
    screen__to_coefficients(p->model, p->parameters, p->centre, q, old);
    screen__evaluate(p, old, 0.0, 0, 1, &before);
    screen__to_box(p->model, p->parameters, p->centre, p->low, p->high, c, trial);
    screen__to_coefficients(p->model, p->parameters, p->centre, trial, cut);
    screen__evaluate(p, cut, 0.0, 0, 1, &after);
    if (!(after.deviation <= before.deviation + 1e-12 && after.squares <= before.squares + 1e-12)) return 0;
    if (!(screen__penalty(p, cut) <= screen__penalty(p, old) + 1e-12)) return 0;
    for (int j = 0; j < p->parameters; j++) q[j] = trial[j];
    return 1;
}

/* Chooses the plainest of equally good sets: exponents without effect become 0, and the slower of the two steps of
   model 2 is called stratification. */
static inline void screen__tidy(screen__problem *p, double *q) {
    double c[SCREEN_MAX_PARAMETERS], other[SCREEN_MAX_PARAMETERS];
    for (int r = 0; r < screen__rates(p->model) && screen__rates(p->model) == 2; r++)
        for (int k = 2; k > 0; k--) {
            screen__to_coefficients(p->model, 6, p->centre, q, c);
            c[3 * r + k] = 0.0;
            screen__prefer(p, c, q);
        }
    screen__to_coefficients(p->model, p->parameters, p->centre, q, c);
    for (int j = 0; j < p->parameters; j++) other[j] = c[(j + 3) % 6];
    if (p->model == SCREEN_SUBASINGHE && c[0] > c[3]) screen__prefer(p, other, q);
}

/* >>student: how wide a range is */

SCREEN_API double screen_student(double level, double dof) {
    /* what is left is of order 1/dof^2 */
    if (dof >= 1e6) return 2.0 * riddle_student(level, 2e6) - riddle_student(level, 1e6);
    return dof >= 1.0 ? riddle_student(level, floor(dof)) : (double)NAN;
}

/* >>judge: errors, correlation, ranges and what is not determined */

/* Residuals of a fit: correlation of neighbours in time, and deviation of whole cases. */
typedef struct screen__residuals {
    double points, squares, lag, pairs; /* number, sum of squares, sum of products of neighbours, number of those */
    double case_squares;                /* mean over cases of their mean square */
} screen__residuals;

static inline screen__residuals screen__look_at_residuals(screen__problem *p, const double *plain) {
    screen__residuals sum = {0.0, 0.0, 0.0, 0.0, 0.0};
    for (int s = 0; s < p->cases; s++) {
        const screen_case *data = &p->data[s];
        const screen_def deck = screen__deck_of(p, s);
        screen__out curve = screen__out_of(data->times, data->time, p->retained);
        const screen__classes classes = screen__classes_of(&p->def, p->decks, p->weights, s);
        double before = sum.squares, points = classes.count * data->times;
        sum.points += points;
        if (screen__curves(&deck, p->model, plain, &data->operation, &curve, p->bed)) continue;
        for (int i = 0; i < deck.classes; i++) {
            const double root = screen__root(&classes, i);
            for (int j = 0; j < data->times && root > 0.0; j++) {
                int k = i * data->times + j;
                double r = root * (p->retained[k] - data->retained[k]);
                sum.squares += r * r;
                if (j == 0) continue;
                sum.lag += r * root * (p->retained[k - 1] - data->retained[k - 1]);
                sum.pairs += 1.0;
            }
        }
        sum.case_squares += (sum.squares - before) / (points * p->cases);
    }
    return sum;
}

/* Returns the variance of the mean of a point's residual: the squared error of a fit to one number. Sets the degrees of
   freedom in *out. */
static inline double screen__variance(const screen__problem *p, const screen_fit_options *options,
                                      const screen__residuals *sum, screen_fit_result *out) {
    int open = 0;
    for (int j = 0; j < p->parameters; j++) open += p->low[j] < p->high[j];
    double rho = sum->squares > 0.0 && sum->pairs > 0.0 ? sum->lag / sum->squares * (sum->points / sum->pairs) : 0.0;
    /* Chance is not correlation. */
    if (!(rho > 2.0 / sqrt(sum->points)) || !(out->rms > options->data_error)) rho = 0.0;
    rho = screen__clip(rho, 0.0, 0.975);
    double alike = (1.0 + rho) / (1.0 - rho), effective = sum->points / alike;
    out->dof = effective - open > 1.0 ? effective - open : 1.0;
    out->student = screen_student(0.95, out->dof);
    double square = sum->squares / (effective - open > 1.0 ? effective - open : 1.0) * (effective / sum->points);
    double least = options->data_error * options->data_error;
    /* of the absolute deviation: a median scatters more than a mean, for normal residuals by this */
    double loss = p->loss == SCREEN_LOSS_DEVIATION ? 0.5 * RIDDLE_PI : 1.0;
    return loss * (square > least ? square : least) / effective;
}

/* Computes the covariance of the free parameters that are at no bound: the curvature is scaled to ones on its diagonal,
   and 1e-13 added there keeps a singular one invertible. Returns 0 if it has no inverse. */
static inline int screen__covariance(int n, screen__matrix curvature, const int *still, double variance,
                                     screen__matrix cov) {
    screen__matrix a;
    double scale[SCREEN_MAX_PARAMETERS];
    for (int i = 0; i < n; i++) scale[i] = curvature[i][i] > 1e-200 && !still[i] ? 1.0 / sqrt(curvature[i][i]) : 0.0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) a[i][j] = i == j ? 1.0 + 1e-13 : curvature[i][j] * scale[i] * scale[j];
    int solved = screen__cholesky(n, a);
    for (int j = 0; j < n; j++) {
        double column[SCREEN_MAX_PARAMETERS] = {0.0};
        column[j] = 1.0;
        if (solved) screen__solve(n, a, column);
        for (int i = 0; i < n; i++) cov[i][j] = variance * scale[i] * scale[j] * column[i];
    }
    return solved;
}

/* Computes the range of a moisture exponent, a quotient of two coefficients: the values g for which
   product - g exponent is 0 within its error (Fieller 1954). Where the exponent may be 0, any g may be true. */
static inline void screen__quotient_range(double exponent, double product, double student, screen__matrix cov, int j,
                                          double *low, double *high) {
    const double t = student * student, a = exponent * exponent - t * cov[j - 1][j - 1],
                 b = exponent * product - t * cov[j - 1][j], c = product * product - t * cov[j][j];
    const double root = b * b - a * c > 0.0 ? sqrt(b * b - a * c) : 0.0;
    const int is_bounded = a > 0.0;
    *low = is_bounded ? (b - root) / a : -HUGE_VAL;
    *high = is_bounded ? (b + root) / a : HUGE_VAL;
}

/* Sets value, error, range and verdict of one parameter; low and high: its range before it is cut at the bounds. */
static inline void screen__judge_one(const screen__problem *p, const screen_fit_options *options, const double *q,
                                     int j, double error, double low, double high, screen_fit_result *out) {
    int rate = screen__is_rate(p->model, j), fixed = options->low[j] == options->high[j],
        idle = !fixed && p->low[j] == p->high[j];
    out->parameter[j] = rate ? riddle_exp(q[j]) : q[j];
    out->at_bound[j] = !fixed && !idle && (q[j] <= p->low[j] || q[j] >= p->high[j]);
    out->error[j] = fixed ? 0.0 : idle ? HUGE_VAL : out->at_bound[j] ? (double)NAN : error;
    const double least = rate ? RIDDLE_LN2_HI : fabs(q[j]) > 1.0 ? fabs(q[j]) : 1.0;
    out->determined[j] = fixed || (!idle && q[j] - low <= least && high - q[j] <= least);
    low = low > p->low[j] ? low : p->low[j];
    high = high < p->high[j] ? high : p->high[j];
    if (idle) { /* held for want of influence: any value will do */
        low = screen__to_q(p->model, j, options->low[j]);
        high = screen__to_q(p->model, j, options->high[j]);
    }
    out->low[j] = rate ? riddle_exp(low) : low;
    out->high[j] = rate ? riddle_exp(high) : high;
    out->undetermined += !out->determined[j];
}

/* Computes the factor of the covariance by c, for screen_sample. Where the data give no information the spread is 2,
   for moisture coefficients 20. */
static inline void screen__judge_factor(const screen__problem *p, const screen__sums *sums, double variance,
                                        screen_fit_result *out) {
    int n = p->parameters;
    double scale[SCREEN_MAX_PARAMETERS];
    screen__matrix a;
    for (int i = 0; i < n; i++) {
        double prior = screen__is_wet(p->model, i) ? 20.0 : 2.0;
        scale[i] = 1.0 / sqrt(sums->curvature[i][i] / variance + 1.0 / (prior * prior));
        for (int j = 0; j < n; j++) a[i][j] = sums->curvature[i][j] / variance + (i == j ? 1.0 / (prior * prior) : 0.0);
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) a[i][j] *= scale[i] * scale[j];
    int solved = screen__cholesky(n, a);
    for (int j = 0; j < n; j++) {
        double column[SCREEN_MAX_PARAMETERS] = {0.0};
        column[j] = 1.0;
        if (solved) screen__solve(n, a, column);
        for (int i = 0; i < n; i++) out->factor[i][j] = scale[i] * scale[j] * column[i];
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++)
            out->factor[i][j] = out->factor[j][i] = 0.5 * (out->factor[i][j] + out->factor[j][i]);
    solved = solved && screen__cholesky(n, out->factor);
    for (int i = 0; i < n; i++)
        for (int j = solved ? i + 1 : 0; j < n; j++) out->factor[i][j] = 0.0;
}

static inline void screen__judge(screen__problem *p, const screen_fit_options *options, const double *q,
                                 screen_fit_result *out) {
    int n = p->parameters, still[SCREEN_MAX_PARAMETERS] = {0}, bounded[SCREEN_MAX_PARAMETERS] = {0};
    double c[SCREEN_MAX_PARAMETERS], plain[SCREEN_MAX_PARAMETERS], unused[SCREEN_MAX_PARAMETERS] = {0.0};
    screen__sums sums;
    screen__matrix t, a, cov, of_all, of_products;
    screen__to_coefficients(p->model, n, p->centre, q, c);
    screen__evaluate(p, c, 0.0, 1, 0, &sums);
    out->deviation = sums.deviation;
    out->rms = sqrt(sums.squares);
    screen__uncentre(p->model, n, p->centre, c, plain);
    screen__residuals residuals = screen__look_at_residuals(p, plain);
    double variance = screen__variance(p, options, &residuals, out);
    /* with few cases the model was bent to them: a case that was not fitted is farther off */
    out->case_error = sqrt(residuals.case_squares * (1.0 + (double)n / (2.0 * p->cases)));
    screen__jacobian(p, q, t);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) a[i][j] = sums.curvature[i][j];
    screen__by_q(n, t, a, unused);
    for (int j = 0; j < n; j++) {
        still[j] = !(p->low[j] < p->high[j]);
        /* a moisture exponent whose exponent is next to 0 may be anything: its bound says nothing of the others */
        const int wet = screen__is_wet(p->model, j);
        bounded[j] = still[j] || (!wet && (q[j] <= p->low[j] || q[j] >= p->high[j]));
    }
    int solved = screen__covariance(n, a, bounded, variance, cov),
        solved_all = screen__covariance(n, a, still, variance, of_all);
    /* Once more by exponent x moisture exponent, in which all is linear where the exponent is 0. */
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) a[i][j] = sums.curvature[i][j], t[i][j] = i == j ? 1.0 : 0.0;
    for (int r = 0; r < screen__rates(p->model); r++)
        t[3 * r][3 * r + 1] = p->centre[2 * r], t[3 * r][3 * r + 2] = p->centre[2 * r + 1];
    screen__by_q(n, t, a, unused);
    const int solved_products = screen__covariance(n, a, bounded, variance, of_products);
    out->undetermined = 0;
    for (int j = 0; j < n; j++) { /* one at its bound has the range of the fit without that bound, cut there */
        double square = bounded[j] ? of_all[j][j] : cov[j][j];
        double error = (bounded[j] ? solved_all : solved) && square > 0.0 ? sqrt(square) : HUGE_VAL;
        double low = q[j] - out->student * error, high = q[j] + out->student * error;
        if (screen__is_wet(p->model, j) && !bounded[j] && !bounded[j - 1] && solved_products)
            screen__quotient_range(c[j - 1], c[j], out->student, of_products, j, &low, &high);
        screen__judge_one(p, options, q, j, error, low, high, out);
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double norm = sqrt(cov[i][i] * cov[j][j]);
            out->correlation[i][j] = i == j ? 1.0 : norm > 0.0 ? screen__clip(cov[i][j] / norm, -1.0, 1.0) : 0.0;
        }
    screen__judge_factor(p, &sums, variance, out);
    for (int j = 0; j < n; j++) out->coefficient[j] = c[j];
}

/* Returns the range of what was fitted. */
static inline screen_domain screen__domain_of(const screen__problem *p) {
    screen_domain d;
    int any = 0;
    for (int s = 0; s < p->cases; s++) {
        const screen_def deck = screen__deck_of(p, s);
        const screen_case *data = &p->data[s];
        screen__widen(d.amplitude, data->operation.amplitude, s == 0);
        screen__widen(d.frequency, data->operation.frequency, s == 0);
        screen__widen(d.moisture, data->operation.moisture, s == 0);
        screen__widen(d.inclination, data->operation.inclination, s == 0);
        screen__widen(d.aperture, deck.aperture, s == 0);
        screen__widen(d.load, screen__load_of(&deck), s == 0);
        screen__widen(d.time, data->time[0], s == 0);
        screen__widen(d.time, data->time[data->times - 1], 0);
        const screen__classes classes = screen__classes_of(&p->def, p->decks, p->weights, s);
        for (int i = 0; i < deck.classes; i++) {
            if (!(screen__root(&classes, i) > 0.0)) continue;
            screen__widen(d.diameter, deck.diameters[i], !any);
            any = 1;
        }
        d.classes[0] = s == 0 || deck.classes < d.classes[0] ? deck.classes : d.classes[0];
        d.classes[1] = s == 0 || deck.classes > d.classes[1] ? deck.classes : d.classes[1];
    }
    return d;
}

static inline screen_status screen__check_options(screen_model model, int n, const screen_fit_options *options) {
    if (options->cookie != SCREEN__FIT_COOKIE || options->starts < 1 || options->starts > SCREEN_MOST_STARTS ||
        options->iterations < 1 || options->iterations > SCREEN_MOST_ITERATIONS ||
        !screen__positive(options->data_error) || !(options->shrink >= 0.0 && options->shrink < HUGE_VAL) ||
        (options->loss != SCREEN_LOSS_DEVIATION && options->loss != SCREEN_LOSS_SQUARES))
        return SCREEN_BAD_OPTION;
    for (int j = 0; j < n && options->start; j++)
        if (!(fabs(options->start[j]) < HUGE_VAL) || (screen__is_rate(model, j) && !(options->start[j] > 0.0)))
            return SCREEN_BAD_OPTION;
    return SCREEN_OK;
}

/* Notes rises and the scatter, and where the first bad datum is, in *out. */
static inline screen_status screen__check_fit(const screen_def *def, screen_model model, int cases,
                                              const screen_case *data, const screen_fit_options *options,
                                              screen_fit_result *out) {
    out->where.index = out->where.klass = out->where.time = -1;
    out->rises = 0;
    out->largest_rise = out->scatter = 0.0;
    screen_status status = screen_check_def(def, NULL);
    if (status) return status;
    int n = screen_parameter_count(model, def->continuous), free_ones = 0;
    if (n == 0 || (model == SCREEN_SOLDINGER && def->continuous)) return SCREEN_BAD_MODEL;
    status = screen__check_options(model, n, options);
    if (!status) status = screen__check_data(def, cases, data, options, out);
    if (status) return status;
    for (int j = 0; j < n; j++) free_ones += !(options->low[j] == options->high[j]);
    double points = 0.0;
    for (int s = 0; s < cases; s++) {
        points += screen__classes_of(def, options->decks, options->class_weights, s).count * data[s].times;
        if (model == SCREEN_DONG && def->continuous && !(data[s].operation.inclination > 0.0)) {
            out->where.index = s;
            return SCREEN_BAD_OPERATION;
        }
    }
    return points < free_ones ? SCREEN_TOO_FEW_POINTS : SCREEN_OK;
}

/* Sets all of a result, except what the check of the data notes; all numbers to `value`. */
static inline void screen__blank(screen_fit_result *result, screen_model model, int parameters, double value) {
    for (int j = 0; j < SCREEN_MAX_PARAMETERS; j++) {
        result->parameter[j] = result->error[j] = result->low[j] = result->high[j] = result->coefficient[j] = value;
        result->determined[j] = result->at_bound[j] = 0;
        for (int k = 0; k < SCREEN_MAX_PARAMETERS; k++) result->correlation[j][k] = result->factor[j][k] = value;
    }
    for (int k = 0; k < 4; k++) result->centre[k] = value;
    result->deviation = result->rms = result->dof = result->student = result->case_error = value;
    screen_domain *d = &result->domain;
    double *ranges[8] = {d->amplitude, d->frequency, d->moisture, d->inclination,
                         d->diameter,  d->aperture,  d->load,     d->time};
    for (int k = 0; k < 16; k++) ranges[k / 2][k % 2] = value;
    d->classes[0] = d->classes[1] = 0;
    result->ratio = SCREEN_RATIO_GRAIN;
    result->ratio_mass = value;
    result->model = model;
    result->parameters = parameters;
    result->undetermined = result->starts = result->starts_at_best = 0;
    result->evaluations = 0;
}

enum { SCREEN__STAGES = 8 };

/* Returns the rounding of |r| at a stage of the descent to the sharp deviation. */
static inline double screen__rounding(int stage) {
    const double rounding[SCREEN__STAGES] = {0.1, 0.03, 0.01, 3e-3, 1e-3, 1e-4, 1e-5, 1e-6};
    return rounding[stage];
}

/* Returns at q what is to be smallest: the deviation or the mean square, with the price. */
static inline double screen__sharp_loss(screen__problem *p, const double *q) {
    double c[SCREEN_MAX_PARAMETERS];
    screen__sums sums;
    screen__to_coefficients(p->model, p->parameters, p->centre, q, c);
    screen__evaluate(p, c, 0.0, 0, 1, &sums);
    return (p->loss == SCREEN_LOSS_SQUARES ? sums.squares : sums.deviation) + screen__price(p, c);
}

/* Takes a trial and its loss for q and the best if it is less. Returns whether it was. */
static inline int screen__take_less(const screen__problem *p, const double *trial, double loss, double *best,
                                    double *q) {
    if (!(loss < *best)) return 0;
    *best = loss;
    for (int j = 0; j < p->parameters; j++) q[j] = trial[j];
    return 1;
}

/* Descends from q through all stages. first: smooth minima that earlier starts came to, [start] pairs of it and the
   sharp loss; a known one is not followed further. Returns the sharp loss; *known: its number, or -1. */
static inline double screen__run_start(screen__problem *p, double *q, int iterations, double *seen, int start,
                                       int *known) {
    int left = iterations, stages = p->loss == SCREEN_LOSS_SQUARES ? 1 : SCREEN__STAGES;
    double loss = HUGE_VAL, price = p->shrink;
    *known = -1;
    /* Each costs 50 times as much there. */
    for (int stage = 0; stage < stages; stage += p->model == SCREEN_SOLDINGER ? 2 : 1) {
        /* model 3's smooth losses have valleys where one step is so fast that its exponents run away: a price on them,
           at first only */
        p->shrink = stage == 0 && stages > 1 && p->model == SCREEN_SOLDINGER && price < 1e-3 ? 1e-3 : price;
        loss = screen__descend(p, q, screen__rounding(stage), stage == 0 ? 150 : 40, &left);
        if (stage == 0 && screen__rates(p->model) == 2)
            loss = screen__second_try(p, q, loss, screen__rounding(0), &left);
        p->shrink = price;
        if (!(loss < HUGE_VAL)) break;
        if (stage > 0 || stages == 1) continue;
        for (int k = 0; k < start; k++)
            if (fabs(seen[2 * k] - loss) <= 1e-9 * loss + 1e-15) *known = k;
        seen[2 * start] = loss;
        if (*known >= 0) return seen[2 * *known + 1];
    }
    if (!(loss < HUGE_VAL)) {
        seen[2 * start] = HUGE_VAL;
        return HUGE_VAL;
    }
    return screen__sharp_loss(p, q);
}

/* Keeps the mean log rate when parameter j has moved from q to trial: another parameter of the same rate
   compensates. */
static inline void screen__keep_mean_rate(const screen__problem *p, const double *q, int j, double *trial) {
    int r = j / 3, k = 3 * r;
    if (p->parameters == 5 && r == 1) return;
    const double *centre = &p->centre[2 * r];
    double mean = q[k] + q[k + 1] * (centre[0] + q[k + 2] * centre[1]), lever = centre[0] + trial[k + 2] * centre[1];
    if (j != k) trial[k] = screen__clip(mean - trial[k + 1] * lever, p->low[k], p->high[k]);
    else if (fabs(lever) > 1e-6) trial[k + 1] = screen__clip((mean - trial[k]) / lever, p->low[k + 1], p->high[k + 1]);
}

/* Tries whether a bound is better: each parameter at each of its bounds, the others fitted again from the best.
   Model 3, whose curves are expensive, tries near bounds only. */
static inline double screen__try_borders(screen__problem *p, double best, double *q) {
    for (int j = 0; j < p->parameters; j++)
        for (int side = 0; side < 2; side++) {
            double low = p->low[j], high = p->high[j], trial[SCREEN_MAX_PARAMETERS],
                   bound = side ? p->box_high[j] : p->box_low[j];
            if (!(p->box_low[j] < p->box_high[j]) || (p->model == SCREEN_SOLDINGER && fabs(q[j] - bound) > 3.0))
                continue;
            for (int k = 0; k < p->parameters; k++) trial[k] = q[k];
            trial[j] = p->low[j] = p->high[j] = bound;
            screen__keep_mean_rate(p, q, j, trial);
            int left = 120, squares = p->loss == SCREEN_LOSS_SQUARES;
            for (int stage = squares ? SCREEN__STAGES - 1 : 2; stage < SCREEN__STAGES; stage += 2)
                screen__descend(p, trial, screen__rounding(stage), squares ? 120 : 30, &left);
            p->low[j] = low;
            p->high[j] = high;
            if (!screen__take_less(p, trial, screen__sharp_loss(p, trial), &best, q)) continue;
            screen__pin_idle(p, q); /* a value without influence, but it may leave k more room */
        }
    return best;
}

/* Returns whether a loss is next to nothing: what would be better then is better by rounding only. */
static inline int screen__is_exact(const screen__problem *p, double loss) {
    return loss <= (p->loss == SCREEN_LOSS_SQUARES ? 1e-18 : 1e-9);
}

/* Returns whether it is worth while to look for more minima everywhere: few curves have many of them, the model is
   cheap, and the best so far is not exact. */
static inline int screen__is_small(const screen__problem *p, double best) {
    int curves = 0;
    for (int s = 0; s < p->cases; s++) curves += screen__deck_of(p, s).classes;
    return curves <= 12 && p->model != SCREEN_SOLDINGER && !screen__is_exact(p, best);
}

/* Tries pairs of bounds: the first may lead uphill. In small problems. */
static inline double screen__try_border_pairs(screen__problem *p, double best, double *q) {
    for (int k = 0; k < 2 * p->parameters && screen__is_small(p, best); k++) {
        const int j = k / 2;
        const double low = p->low[j], high = p->high[j];
        double trial[SCREEN_MAX_PARAMETERS];
        int left = 120;
        if (!(low < high)) continue;
        for (int i = 0; i < p->parameters; i++) trial[i] = q[i];
        trial[j] = p->low[j] = p->high[j] = k % 2 ? high : low;
        screen__keep_mean_rate(p, q, j, trial);
        screen__descend(p, trial, screen__rounding(SCREEN__STAGES - 1), 120, &left);
        const double loss = screen__try_borders(p, screen__sharp_loss(p, trial), trial);
        p->low[j] = low;
        p->high[j] = high;
        screen__take_less(p, trial, loss, &best, q);
        screen__pin_idle(p, q);
    }
    return best;
}

static inline double screen__last_time(const screen__problem *p) {
    double last = 0.0;
    for (int s = 0; s < p->cases; s++) {
        double end = p->data[s].time[p->data[s].times - 1];
        last = end > last ? end : last;
    }
    return last > 0.0 ? last : p->def.duration;
}

/* Descends from `trial`, of deviations from the stage `first` on. Takes the place where that ends for q if it is
   better; returns the better loss. */
static inline double screen__try_at(screen__problem *p, int first, double *trial, double best, double *q) {
    int left = 100;
    for (int stage = p->loss == SCREEN_LOSS_SQUARES ? SCREEN__STAGES - 1 : first; stage < SCREEN__STAGES; stage += 2)
        screen__descend(p, trial, screen__rounding(stage), 40, &left);
    screen__take_less(p, trial, screen__sharp_loss(p, trial), &best, q);
    return best;
}

/* The same from coefficients c. */
static inline double screen__try_from(screen__problem *p, const double *c, double best, double *q) {
    double trial[SCREEN_MAX_PARAMETERS];
    screen__to_box(p->model, p->parameters, p->centre, p->low, p->high, c, trial);
    return screen__try_at(p, 0, trial, best, q);
}

/* Descends once more from each pair of plain rates (slow, middling and fast) without exponents: few data have minima
   that random starts miss. */
static inline double screen__try_plain_rates(screen__problem *p, double best, double *q) {
    const double first = p->model == SCREEN_DONG ? 3.0 : -riddle_log(screen__last_time(p));
    int pairs = p->model == SCREEN_SOLDINGER || p->parameters == 5 ? 0 : screen__rates(p->model) == 2 ? 9 : 3;
    for (int k = 0; k < pairs; k++) {
        double c[SCREEN_MAX_PARAMETERS] = {0.0};
        c[0] = first + 2.5 * (k % 3);
        c[3] = first + 2.5 * (double)(k / 3);
        best = screen__try_from(p, c, best, q);
    }
    return best;
}

/* Descends from rates that change by e^2 or e^6 with the speeds or moistures of the data, the two of model 2 in
   opposite directions: where a rate has its peak within the data, each step limits on one side of it. */
static inline double screen__try_opposed_rates(screen__problem *p, double best, double *q) {
    const double first = p->model == SCREEN_DONG ? 3.0 : -riddle_log(screen__last_time(p));
    const int rates = screen__rates(p->model), tries = p->model == SCREEN_SOLDINGER || p->parameters == 5 ? 0 : 32;
    for (int k = 0; k < tries && !screen__is_exact(p, best); k++) {
        double c[SCREEN_MAX_PARAMETERS] = {0.0};
        const int shape = k / 8; /* by speed, by moisture, by both, by both in opposite directions */
        for (int r = 0; r < rates; r++) {
            const double reach = (k & 1 ? 6.0 : 2.0) * (((k & 2) != 0) == (r != 0) ? 1.0 : -1.0),
                         *width = &p->width[2 * r];
            c[3 * r] = first + (k & 4 ? 4.0 : 1.5);
            c[3 * r + 1] = shape != 1 && width[0] > 1e-12 ? reach / width[0] : 1.0;
            c[3 * r + 2] = shape != 0 && width[1] > 1e-12 ? (shape == 3 ? -reach : reach) / width[1] : 0.0;
        }
        best = screen__try_from(p, c, best, q);
    }
    return best;
}

/* Descends from `starts` random starts with parameter j at a bound. */
static inline double screen__try_border_anew(screen__problem *p, int j, double bound, int starts, uint64_t *state,
                                             double best, double *q) {
    const double low = p->low[j], high = p->high[j], last_time = screen__last_time(p);
    p->low[j] = p->high[j] = bound;
    for (int k = 0; k < starts; k++) {
        double trial[SCREEN_MAX_PARAMETERS];
        screen__random_start(p, last_time, state, trial);
        if (screen__rates(p->model) == 2) {
            int left = 300;
            const double loss = screen__descend(p, trial, screen__rounding(0), 150, &left);
            screen__second_try(p, trial, loss, screen__rounding(0), &left);
        }
        best = screen__try_at(p, 0, trial, best, q);
    }
    p->low[j] = low, p->high[j] = high;
    return best;
}

/* The same with each parameter at each of its bounds, in small problems; more often where the best so far stands
   at that bound. */
static inline double screen__try_borders_anew(screen__problem *p, uint64_t seed, double best, double *q) {
    for (int j = 0; j < p->parameters && screen__is_small(p, best); j++) {
        uint64_t state = seed;
        if (!(p->low[j] < p->high[j])) continue;
        for (int side = 0; side < 2; side++) {
            const double bound = side ? p->high[j] : p->low[j];
            best = screen__try_border_anew(p, j, bound, q[j] == bound ? 24 : 6, &state, best, q);
        }
    }
    return best;
}

/* Where exponents have a price their bounds are too dear to lead anywhere: each exponent at -2 and 2 from random
   starts, then released. In small problems. */
static inline double screen__try_modest_exponents(screen__problem *p, uint64_t seed, double best, double *q) {
    for (int k = 0; k < 2 * screen__rates(p->model) && p->shrink > 0.0 && screen__is_small(p, best); k++) {
        const int j = k / 2 * 3 + 1;
        const double at = screen__clip(k % 2 ? 2.0 : -2.0, p->low[j], p->high[j]);
        double trial[SCREEN_MAX_PARAMETERS];
        uint64_t state = seed;
        if (!(p->low[j] < p->high[j]) || !(screen__try_border_anew(p, j, at, 6, &state, HUGE_VAL, trial) < HUGE_VAL))
            continue;
        best = screen__try_at(p, 5, trial, best, q);
    }
    return best;
}

/* Exchanges the two steps of model 2 and descends: the curves differ where a bound holds one of them. */
static inline double screen__try_exchanged(screen__problem *p, double best, double *q) {
    double c[SCREEN_MAX_PARAMETERS], other[SCREEN_MAX_PARAMETERS];
    if (p->model != SCREEN_SUBASINGHE || screen__is_exact(p, best)) return best;
    screen__to_coefficients(p->model, p->parameters, p->centre, q, c);
    for (int j = 0; j < p->parameters; j++) other[j] = c[(j + 3) % 6];
    return screen__try_from(p, other, best, q);
}

/* Runs all starts; the best ends in best_q. seen[starts][2]: the loss of each start after the first stage, and
   its sharp loss. */
static inline double screen__search(screen__problem *p, const screen_fit_options *options, double *seen,
                                    double *best_q) {
    double best = HUGE_VAL, q[SCREEN_MAX_PARAMETERS], last_time = screen__last_time(p);
    uint64_t state = options->seed;
    for (int start = 0; start < options->starts; start++) {
        int known;
        screen__random_start(p, last_time, &state, q);
        if (start == 0 && options->start)
            for (int j = 0; j < p->parameters; j++)
                q[j] = screen__clip(screen__to_q(p->model, j, options->start[j]), p->low[j], p->high[j]);
        double loss = screen__run_start(p, q, options->iterations, seen, start, &known);
        seen[2 * start + 1] = loss;
        if (known >= 0 || !(loss < best)) continue;
        best = loss;
        for (int j = 0; j < p->parameters; j++) best_q[j] = q[j];
    }
    return best;
}

/* Moves parameters without influence back to where they are held, and k such that the rates stay; as far as the bounds
   of k and of the moisture exponents allow. */
static inline void screen__send_home(screen__problem *p, double *q) {
    for (int j = 0; j < p->parameters; j++) {
        const int tilt = p->parameters == 5 && j == 4, k = tilt ? 0 : j - j % 3;
        const double *centre = &p->centre[tilt ? 0 : 2 * (j / 3)];
        double trial[SCREEN_MAX_PARAMETERS];
        if (!p->idle[j]) continue;
        for (int i = 0; i < p->parameters; i++) trial[i] = q[i];
        trial[j] = p->home[j];
        if (j == k + 1 && !p->idle[j + 1] && fabs(trial[j]) > 1e-300)
            trial[j + 1] = screen__clip(q[j] * q[j + 1] / trial[j], p->low[j + 1], p->high[j + 1]);
        trial[k] += tilt ? p->slope * (q[j] - trial[j])
                         : q[k + 1] * (centre[0] + q[k + 2] * centre[1]) -
                               trial[k + 1] * (centre[0] + trial[k + 2] * centre[1]);
        const double beyond = trial[k] - screen__clip(trial[k], p->low[k], p->high[k]),
                     lever = trial[k + 1] * centre[1];
        trial[k] -= beyond;
        if (beyond != 0.0 && j == k + 2 && fabs(lever) > 1e-6) /* as near to it as k's bound allows */
            trial[j] = screen__clip(trial[j] + beyond / lever, p->box_low[j], p->box_high[j]);
        if (!(screen__sharp_loss(p, trial) <= screen__sharp_loss(p, q) * (1.0 + 1e-9) + 1e-12)) continue;
        for (int i = 0; i < p->parameters; i++) q[i] = trial[i];
    }
    screen__pin_idle(p, q);
}

/* Tries the bounds, takes the last steps with the caller's tolerance, and computes the result. */
static inline void screen__finish(screen__problem *p, const screen_def *def, const screen_fit_options *options,
                                  const double *seen, double best, double *q, screen_fit_result *result) {
    int left = p->model == SCREEN_SOLDINGER ? 12 : 600,
        stage = options->loss == SCREEN_LOSS_SQUARES ? 0 : SCREEN__STAGES - 1;
    for (int start = 0; start < options->starts; start++) result->starts_at_best += seen[2 * start + 1] <= best + 1e-6;
    result->starts = options->starts;
    best = screen__try_plain_rates(p, best, q);
    best = screen__try_opposed_rates(p, best, q);
    best = screen__try_borders_anew(p, options->seed, best, q);
    best = screen__try_modest_exponents(p, options->seed, best, q);
    for (int round = 0; round < 3; round++) { /* from one border another may be near */
        double before = best;
        best = screen__try_exchanged(p, best, q);
        best = screen__try_borders(p, best, q);
        best = screen__try_border_pairs(p, best, q);
        if (!(best < before * (1.0 - 1e-9))) break;
    }
    p->def.tolerance = def->tolerance;
    p->last_steps = 1;
    screen__send_home(p, q); /* before the last steps too: a price counts the product of both exponents */
    screen__descend(p, q, screen__rounding(stage), left, &left);
    for (int k = 0; k < 4; k++) result->centre[k] = p->centre[k];
    screen__tidy(p, q);
    screen__send_home(p, q);
    screen__judge(p, options, q, result);
    result->domain = screen__domain_of(p);
    result->ratio = screen__deck_of(p, 0).ratio;
    result->ratio_mass = screen__deck_of(p, 0).ratio_mass;
    result->evaluations = p->evaluations;
}

SCREEN_API screen_status screen_fit(const screen_def *def, screen_model model, int cases, const screen_case *data,
                                    const screen_fit_options *options, screen_fit_result *result) {
    screen_fit_options defaults = screen_default_fit_options(model);
    screen__problem p;
    if (!result) return SCREEN_BAD_POINTER;
    if (!options) options = &defaults;
    screen_status status = screen__check_fit(def, model, cases, data, options, result);
    screen__blank(result, model, 0, (double)NAN);
    if (status) return status;
    status = screen__pose(&p, def, model, cases, data, options);
    double *seen = status ? NULL : (double *)screen__take(&def->memory, 2 * (size_t)options->starts, sizeof(double));
    if (!status && !seen) status = SCREEN_NO_MEMORY;
    double q[SCREEN_MAX_PARAMETERS], best = status ? HUGE_VAL : screen__search(&p, options, seen, q);
    if (!status && !(best < HUGE_VAL)) status = SCREEN_NOT_FINITE;
    if (!status) {
        screen__blank(result, model, p.parameters, 0.0);
        screen__finish(&p, def, options, seen, best, q, result);
    }
    screen__release(&def->memory, seen, 2 * (size_t)options->starts, sizeof(double));
    screen__dispose(&p);
    return status;
}

SCREEN_API screen_status screen_profile(const screen_def *def, int cases, const screen_case *data,
                                        const screen_fit_options *options, const screen_fit_result *result, int index,
                                        double rise, double *low, double *high) {
    screen__problem p;
    screen_fit_result noted;
    if (!result || !low || !high) return SCREEN_BAD_POINTER;
    *low = *high = (double)NAN;
    screen_fit_options defaults = screen_default_fit_options(result->model);
    if (!options) options = &defaults;
    screen_status status = screen__check_fit(def, result->model, cases, data, options, &noted);
    if (status) return status;
    if (index < 0 || index >= result->parameters || !screen__positive(rise)) return SCREEN_BAD_ARGUMENT;
    status = screen__pose(&p, def, result->model, cases, data, options);
    if (status) {
        screen__dispose(&p);
        return status;
    }
    int squares = options->loss == SCREEN_LOSS_SQUARES;
    double centre_q[SCREEN_MAX_PARAMETERS], centre_c[SCREEN_MAX_PARAMETERS], box_low = p.box_low[index],
                                                                             box_high = p.box_high[index];
    for (int j = 0; j < result->parameters; j++) centre_q[j] = screen__to_q(result->model, j, result->parameter[j]);
    for (int j = 0; j < p.parameters; j++) /* one that gave way to a bound of k may do so again */
        if (p.idle[j] && centre_q[j] != p.home[j]) p.low[j] = p.box_low[j], p.high[j] = p.box_high[j];
    screen__to_coefficients(result->model, result->parameters, p.centre, centre_q, centre_c);
    double limit = (squares ? result->rms * result->rms : result->deviation) + screen__price(&p, centre_c) + rise;
    for (int side = 0; side < 2; side++) {
        double edge = side ? box_high : box_low, sign = side ? 1.0 : -1.0, outside = edge;
        double inside = p.idle[index] ? edge : centre_q[index]; /* of one without influence any value will do */
        double q[SCREEN_MAX_PARAMETERS],
            step = 0.02 * (1.0 + fabs(inside)) * (screen__is_rate(result->model, index) ? 0.2 : 1.0);
        int found = 0;
        for (int j = 0; j < result->parameters; j++) q[j] = centre_q[j];
        for (int it = 0; it < 60 && fabs(edge - inside) > 0.0; it++) {
            double at = found ? 0.5 * (inside + outside) : inside + sign * step;
            if (!found && sign * (at - edge) >= 0.0) at = edge;
            if (found && fabs(outside - inside) < 1e-3 * (1e-3 + fabs(outside - centre_q[index]))) break;
            double trial[SCREEN_MAX_PARAMETERS];
            int left = 200;
            for (int j = 0; j < result->parameters; j++) trial[j] = q[j];
            trial[index] = p.low[index] = p.high[index] = at;
            const double rounding[] = {1e-2, 1e-3, 1e-4};
            for (int stage = squares ? 2 : 0; stage < 3; stage++)
                screen__descend(&p, trial, rounding[stage], 40, &left);
            if (screen__sharp_loss(&p, trial) <= limit) {
                inside = at;
                step *= 2.0;
                for (int j = 0; j < result->parameters; j++) q[j] = trial[j];
            } else {
                outside = at;
                found = 1;
            }
        }
        double value = screen__is_rate(result->model, index) ? riddle_exp(inside) : inside;
        *(side ? high : low) = value;
    }
    screen__dispose(&p);
    return status;
}

SCREEN_API screen_status screen_sample(const screen_fit_result *result, const screen_fit_options *options,
                                       uint64_t seed, int n, double *sets) {
    if (!result || !sets) return SCREEN_BAD_POINTER;
    screen_fit_options defaults = screen_default_fit_options(result->model);
    double low[SCREEN_MAX_PARAMETERS], high[SCREEN_MAX_PARAMETERS];
    int parameters = result->parameters;
    if (!options) options = &defaults;
    if (n < 1) return SCREEN_BAD_ARGUMENT;
    size_t numbers = (size_t)n * SCREEN_MAX_PARAMETERS;
    if (parameters < 1 || parameters > SCREEN_MAX_PARAMETERS) return screen__leave(SCREEN_BAD_ARGUMENT, numbers, sets);
    for (int j = 0; j < parameters; j++) {
        if (!(options->low[j] <= options->high[j]) || (screen__is_rate(result->model, j) && !(options->low[j] > 0.0)))
            return screen__leave(SCREEN_BAD_BOUNDS, numbers, sets);
        low[j] = screen__to_q(result->model, j, options->low[j]);
        high[j] = screen__to_q(result->model, j, options->high[j]);
    }
    for (int s = 0; s < n; s++) {
        double z[SCREEN_MAX_PARAMETERS], c[SCREEN_MAX_PARAMETERS], q[SCREEN_MAX_PARAMETERS];
        for (int j = 0; j < parameters; j++) z[j] = screen__normal(&seed);
        for (int j = 0; j < parameters; j++) {
            c[j] = result->coefficient[j];
            for (int k = 0; k <= j; k++) c[j] += result->factor[j][k] * z[k];
        }
        screen__to_box(result->model, parameters, result->centre, low, high, c, q);
        for (int j = 0; j < SCREEN_MAX_PARAMETERS; j++)
            sets[s * SCREEN_MAX_PARAMETERS + j] = j >= parameters                     ? 0.0
                                                  : screen__is_rate(result->model, j) ? riddle_exp(q[j])
                                                                                      : q[j];
    }
    return SCREEN_OK;
}

/* >>bands */

static inline void screen__sort(double *x, int n) { /* Shell, gaps of Ciura: a few hundred numbers */
    const int gaps[] = {701, 301, 132, 57, 23, 10, 4, 1};
    for (int g = 0; g < 8; g++)
        for (int i = gaps[g]; i < n; i++) {
            double value = x[i];
            int j = i;
            for (; j >= gaps[g] && x[j - gaps[g]] > value; j -= gaps[g]) x[j] = x[j - gaps[g]];
            x[j] = value;
        }
}

static inline double screen__quantile(const double *sorted, int n, double share) {
    double at = share * (n - 1), below = floor(at);
    int i = (int)below;
    return i + 1 < n ? sorted[i] + (at - below) * (sorted[i + 1] - sorted[i]) : sorted[n - 1];
}

SCREEN_API screen_status screen_band(const screen_def *def, screen_model model, int n, const double *sets,
                                     const screen_operation *operation, int times, const double *time, double scatter,
                                     uint64_t seed, double level, double *mean, double *spread, double *low,
                                     double *high) {
    screen_status status = screen_check_def(def, NULL);
    if (!status) status = screen_check_operation(operation);
    if (!status) status = screen__check_times(times, time);
    if (!status && !sets) status = SCREEN_BAD_POINTER;
    if (!status && (n < 2 || !(scatter >= 0.0 && scatter < HUGE_VAL) || !(level > 0.0 && level < 1.0)))
        status = SCREEN_BAD_ARGUMENT;
    size_t points = screen__size(def, times), rows = n > 0 ? (size_t)n : 1;
    double *curve = NULL, *value = NULL; /* [points][n] */
    int good = 0;
    if (!status) {
        curve = (double *)screen__take(&def->memory, points, sizeof(double));
        if (points <= (size_t)-1 / rows) value = (double *)screen__take(&def->memory, points * rows, sizeof(double));
        if (!curve || !value) status = SCREEN_NO_MEMORY;
    }
    for (int s = 0; s < n && !status; s++) {
        screen_status one =
            screen_predict(def, model, sets + s * SCREEN_MAX_PARAMETERS, operation, times, time, curve, NULL, NULL);
        if (one == SCREEN_NO_MEMORY || one == SCREEN_BAD_MODEL) status = one;
        if (one && one != SCREEN_OUTSIDE) continue;
        /* at all times the same: quantiles are smooth */
        const double error = scatter > 0.0 ? scatter * screen__normal(&seed) : 0.0;
        for (size_t k = 0; k < points; k++) value[k * rows + (size_t)good] = screen__clip(curve[k] + error, 0.0, 1.0);
        good++;
    }
    if (!status && good < 2) status = SCREEN_NOT_FINITE;
    for (size_t k = 0; k < points && !status; k++) {
        double *x = value + k * rows, sum = 0.0, squares = 0.0;
        screen__sort(x, good);
        for (int s = 0; s < good; s++) sum += x[s];
        sum /= good;
        for (int s = 0; s < good; s++) squares += (x[s] - sum) * (x[s] - sum);
        if (mean) mean[k] = sum;
        if (spread) spread[k] = sqrt(squares / (good - 1));
        if (low) low[k] = screen__quantile(x, good, 0.5 * (1.0 - level));
        if (high) high[k] = screen__quantile(x, good, 0.5 * (1.0 + level));
    }
    if (curve) screen__release(&def->memory, curve, points, sizeof(double));
    if (value) screen__release(&def->memory, value, points * rows, sizeof(double));
    screen__leave(status, points, mean);
    screen__leave(status, points, spread);
    screen__leave(status, points, low);
    return screen__leave(status, points, high);
}

SCREEN_API screen_status screen_fit_band(const screen_def *def, const screen_fit_result *result,
                                         const screen_fit_options *options, const screen_operation *operation,
                                         int times, const double *time, double level, uint64_t seed, double *mean,
                                         double *low, double *high) {
    enum { SETS = 200 };
    double sets[(int)SETS * SCREEN_MAX_PARAMETERS];
    screen_status status = result ? screen_sample(result, options, seed, SETS, sets) : SCREEN_BAD_POINTER;
    if (!status)
        return screen_band(def, result->model, SETS, sets, operation, times, time, result->case_error, seed + 1, level,
                           mean, NULL, low, high);
    screen__leave(status, screen__size(def, times), mean);
    screen__leave(status, screen__size(def, times), low);
    return screen__leave(status, screen__size(def, times), high);
}

/* >>separation */

/* Returns the point at which the curve has risen through level: from point `from` on upwards (step 1) or downwards (-1)
   the first such; 0 where it begins at the level, -1 if it does not rise through it. */
static inline int screen__rise(int n, const double *y, double level, int from, int step) {
    for (int i = from > 1 ? from : 1; i > 0 && i < n; i += step)
        if (y[i] >= level && y[i - 1] < level) return i;
    return step < 0 && y[0] == level ? 0 : -1;
}

/* Returns the size at that point; NaN for -1. */
static inline double screen__size_at(const double *d, const double *y, double level, int point) {
    if (point < 1) return point == 0 ? d[0] : (double)NAN;
    return d[point - 1] + (d[point] - d[point - 1]) * ((level - y[point - 1]) / (y[point] - y[point - 1]));
}

SCREEN_API screen_status screen_measure(int n, const double *diameters, const double *feed, const double *partition,
                                        double cut, screen_separation *out) {
    if (!out) return SCREEN_BAD_POINTER;
    out->d25 = out->d50 = out->d75 = out->ecart = out->imperfection = out->recovery = out->oversize_loss = (double)NAN;
    out->misplaced_overflow = out->misplaced_underflow = out->efficiency = out->yield = (double)NAN;
    if (!diameters || !feed || !partition) return SCREEN_BAD_POINTER;
    if (n < 1 || !screen__positive(cut)) return SCREEN_BAD_ARGUMENT;
    double fine = 0.0, coarse = 0.0, fine_stays = 0.0, coarse_stays = 0.0;
    for (int i = 0; i < n; i++) {
        if (!screen__positive(diameters[i]) || (i > 0 && !(diameters[i] > diameters[i - 1])))
            return SCREEN_BAD_ARGUMENT;
        if (!(feed[i] >= 0.0 && feed[i] < HUGE_VAL)) return SCREEN_BAD_ARGUMENT;
        if (partition[i] > 1.5) return SCREEN_DATA_IN_PERCENT;
        if (!(partition[i] >= 0.0 && partition[i] <= 1.0)) return SCREEN_DATA_OUT_OF_RANGE;
        *(diameters[i] < cut ? &fine : &coarse) += feed[i];
        *(diameters[i] < cut ? &fine_stays : &coarse_stays) += feed[i] * partition[i];
    }
    double all = fine + coarse, stays = fine_stays + coarse_stays,
           passes = (fine - fine_stays) + (coarse - coarse_stays);
    if (!(all > 0.0 && all < HUGE_VAL)) return SCREEN_BAD_ARGUMENT;
    int middle = screen__rise(n, partition, 0.50, n - 1, -1), upwards = middle >= 0 ? 1 : -1;
    int first = screen__rise(n, partition, 0.25, middle >= 0 ? middle : n - 1, -1);
    int last = screen__rise(n, partition, 0.75, middle >= 0 ? middle : n - 1, upwards);
    out->d25 = screen__size_at(diameters, partition, 0.25, first);
    out->d50 = screen__size_at(diameters, partition, 0.50, middle);
    out->d75 = screen__size_at(diameters, partition, 0.75, last);
    out->ecart = out->d75 >= out->d25 ? 0.5 * (out->d75 - out->d25) : (double)NAN;
    out->imperfection = out->ecart / out->d50;
    out->recovery = fine > 0.0 ? (fine - fine_stays) / fine : (double)NAN;
    out->oversize_loss = coarse > 0.0 ? (coarse - coarse_stays) / coarse : (double)NAN;
    out->misplaced_overflow = stays > 0.0 ? fine_stays / stays : (double)NAN;
    out->misplaced_underflow = passes > 0.0 ? (coarse - coarse_stays) / passes : (double)NAN;
    out->efficiency = out->recovery - out->oversize_loss;
    out->yield = passes / all;
    return out->imperfection == out->imperfection ? SCREEN_OK : SCREEN_NOT_REACHED;
}

/* Lists the numbers of a separation. */
enum { SCREEN__SEPARATION = 11 };
static inline void screen__list_separation(screen_separation *s, double *list[SCREEN__SEPARATION]) {
    double *const all[SCREEN__SEPARATION] = {&s->d25,           &s->d50,
                                             &s->d75,           &s->ecart,
                                             &s->imperfection,  &s->recovery,
                                             &s->oversize_loss, &s->misplaced_overflow,
                                             &s->efficiency,    &s->misplaced_underflow,
                                             &s->yield};
    for (int k = 0; k < SCREEN__SEPARATION; k++) list[k] = all[k];
}

SCREEN_API screen_status screen_measure_range(int n, const double *diameters, const double *feed, const double *feed_sd,
                                              const double *partition, const double *partition_sd, double cut,
                                              uint64_t seed, const screen_memory *memory, screen_separation *low,
                                              screen_separation *high) {
    enum { DRAWS = 1000 };
    const screen_memory library = {NULL, NULL}, *hook = memory ? memory : &library;
    screen_separation measured, drawn;
    double *value[SCREEN__SEPARATION], *at[SCREEN__SEPARATION], *from[SCREEN__SEPARATION], *to[SCREEN__SEPARATION];
    double number[SCREEN__SEPARATION] = {0.0}, sum[SCREEN__SEPARATION] = {0.0}, squares[SCREEN__SEPARATION] = {0.0};
    if (!low || !high) return SCREEN_BAD_POINTER;
    screen__list_separation(low, from), screen__list_separation(high, to);
    screen__list_separation(&measured, value), screen__list_separation(&drawn, at);
    for (int k = 0; k < SCREEN__SEPARATION; k++) *from[k] = *to[k] = (double)NAN;
    if (!partition_sd) return SCREEN_BAD_POINTER;
    const screen_status status = screen_measure(n, diameters, feed, partition, cut, &measured);
    if (status != SCREEN_OK && status != SCREEN_NOT_REACHED) return status;
    for (int i = 0; i < n; i++)
        if (!(partition_sd[i] >= 0.0 && partition_sd[i] < HUGE_VAL &&
              (!feed_sd || (feed_sd[i] >= 0.0 && feed_sd[i] < HUGE_VAL))))
            return SCREEN_BAD_ARGUMENT;
    double *sets = (double *)screen__take(hook, 2 * (size_t)n, sizeof(double));
    if (!sets) return SCREEN_NO_MEMORY;
    for (int draw = 0; draw < DRAWS; draw++) {
        for (int i = 0; i < n; i++) {
            const double f = feed[i] + (feed_sd ? feed_sd[i] * screen__normal(&seed) : 0.0),
                         p = partition[i] + partition_sd[i] * screen__normal(&seed);
            sets[i] = f > 0.0 ? f : 0.0;
            sets[n + i] = screen__clip(p, 0.0, 1.0);
        }
        (void)screen_measure(n, diameters, sets, sets + n, cut, &drawn);
        for (int k = 0; k < SCREEN__SEPARATION; k++) {
            const double off = *at[k] - *value[k];
            if (!(fabs(off) < HUGE_VAL)) continue;
            number[k] += 1.0, sum[k] += off, squares[k] += off * off;
        }
    }
    screen__release(hook, sets, 2 * (size_t)n, sizeof(double));
    for (int k = 0; k < SCREEN__SEPARATION; k++) {
        if (!(number[k] >= 0.95 * (int)DRAWS)) continue;
        const double variance = (squares[k] - sum[k] * sum[k] / number[k]) / (number[k] - 1.0),
                     reach = variance > 0.0 ? 1.959963984540054 * sqrt(variance) : 0.0;
        *from[k] = *value[k] - reach, *to[k] = *value[k] + reach;
    }
    return status;
}

/* >>feed */

/* Returns the share finer than d: straight lines between the points, and from (0, 0) to the first. */
static inline double screen__finer(int points, const double *size, const double *passing, double d) {
    if (!(d > size[0])) return passing[0] * (d / size[0]);
    for (int i = 1; i < points; i++)
        if (d <= size[i])
            return passing[i - 1] + (passing[i] - passing[i - 1]) * ((d - size[i - 1]) / (size[i] - size[i - 1]));
    return passing[points - 1];
}

/* Mass between two shares and its first moment by size, up to the aperture. */
static inline double screen__moment_of_curve(int points, const double *size, const double *passing, double from,
                                             double to) {
    double moment = 0.0;
    for (int i = 0; i < points; i++) {
        double p0 = i > 0 ? passing[i - 1] : 0.0, p1 = passing[i], d0 = i > 0 ? size[i - 1] : 0.0, d1 = size[i];
        double a = p0 > from ? p0 : from, b = p1 < to ? p1 : to;
        if (!(b > a)) continue;
        double at_a = d0 + (d1 - d0) * ((a - p0) / (p1 - p0)), at_b = d0 + (d1 - d0) * ((b - p0) / (p1 - p0));
        moment += 0.5 * (at_a + at_b) * (b - a);
    }
    return moment;
}

SCREEN_API screen_status screen_classes(int points, const double *size, const double *passing, double aperture,
                                        int classes, double *diameters, double *shares, double *undersize) {
    if (undersize) *undersize = (double)NAN;
    if (!diameters) return SCREEN_BAD_POINTER;
    if (classes < 1) return SCREEN_BAD_ARGUMENT;
    for (int i = 0; i < classes; i++) diameters[i] = (double)NAN;
    for (int i = 0; i < classes && shares; i++) shares[i] = (double)NAN;
    if (!size || !passing) return SCREEN_BAD_POINTER;
    if (points < 1 || !screen__positive(aperture)) return SCREEN_BAD_ARGUMENT;
    for (int i = 0; i < points; i++) {
        if (passing[i] > 1.5 && passing[i] <= 100.5) return SCREEN_DATA_IN_PERCENT;
        if (!screen__positive(size[i]) || (i > 0 && !(size[i] > size[i - 1]))) return SCREEN_BAD_CURVE;
        if (!(passing[i] >= 0.0 && passing[i] <= 1.0 + 1e-9) || (i > 0 && !(passing[i] >= passing[i - 1])))
            return SCREEN_BAD_CURVE;
    }
    if (size[points - 1] < aperture && passing[points - 1] < 1.0 - 1e-6) return SCREEN_BAD_CURVE;
    double below = screen__finer(points, size, passing, aperture);
    if (!(below > 1e-12)) return SCREEN_BAD_CURVE;
    for (int i = 0; i < classes; i++) {
        double from = below * i / classes, to = below * (i + 1.0) / classes;
        diameters[i] = screen__moment_of_curve(points, size, passing, from, to) / (to - from);
        if (!(diameters[i] < aperture)) diameters[i] = aperture * (1.0 - 1e-9); /* rounding only */
        if (shares) shares[i] = 1.0 / classes;
    }
    if (undersize) *undersize = below;
    return SCREEN_OK;
}

/* >>deck */

static inline int screen__good_duty(const screen_duty *duty) {
    return duty && screen__positive(duty->width) && screen__positive(duty->length) &&
           screen__positive(duty->velocity) && screen__positive(duty->feed) &&
           screen__positive(duty->feed / duty->width / duty->velocity) &&
           screen__positive(duty->length / duty->velocity);
}

/* Returns def with the masses of a slice. */
static inline screen_def screen__slice(const screen_def *def, const screen_duty *duty) {
    screen_def slice = *def;
    double scale = duty->feed / (duty->width * duty->velocity) / screen__load_of(def);
    slice.undersize_mass *= scale;
    slice.oversize_mass *= scale;
    return slice;
}

static inline void screen__sum_flow(const screen_def *slice, const screen_duty *duty, int places,
                                    const double *retained, double *depth, double *passed, screen_flow *flow) {
    double total = slice->undersize_mass + slice->oversize_mass, fine = 0.0, fine_passed = 0.0, all_passed = 0.0,
           shares = 0.0;
    /* a sum: the difference to the feed could be below 0 by rounding */
    double stays = duty->feed * slice->oversize_mass / total;
    for (int i = 0; i < slice->classes; i++) shares += screen__share(slice, i);
    for (int i = 0; i < slice->classes; i++) {
        double fed = duty->feed * slice->undersize_mass / total * screen__share(slice, i) / shares;
        double y = retained[(size_t)i * (size_t)places + (size_t)places - 1], through = fed * (1.0 - y);
        if (passed) passed[i] = through;
        all_passed += through;
        stays += fed * y;
        if (!(slice->diameters[i] < slice->aperture)) continue;
        fine += fed;
        fine_passed += through;
    }
    for (int j = 0; j < places; j++) {
        double on_deck = slice->oversize_mass;
        for (int i = 0; i < slice->classes; i++)
            on_deck += slice->undersize_mass * screen__share(slice, i) / shares *
                       retained[(size_t)i * (size_t)places + (size_t)j];
        flow->load_end = on_deck / slice->deck_area;
        flow->depth_end = flow->load_end / slice->bulk_density;
        if (depth) depth[j] = flow->depth_end;
    }
    flow->load = screen__load_of(slice);
    flow->depth = flow->load / slice->bulk_density;
    flow->residence = duty->length / duty->velocity;
    flow->passed = all_passed;
    flow->stays = stays;
    flow->efficiency = fine > 0.0 ? fine_passed / fine : (double)NAN;
    flow->purity = all_passed > 0.0 ? fine_passed / all_passed : (double)NAN;
    flow->undersize_in_overflow = flow->stays > 0.0 ? (fine - fine_passed) / flow->stays : (double)NAN;
}

SCREEN_API screen_status screen_steady(const screen_def *def, screen_model model, const double *parameters,
                                       const screen_operation *operation, const screen_duty *duty, int places,
                                       double *retained, double *depth, double *passed, screen_flow *flow) {
    screen_status status = screen_check_def(def, NULL);
    if (flow)
        flow->load = flow->depth = flow->load_end = flow->depth_end = flow->residence = flow->passed = flow->stays =
            flow->efficiency = flow->purity = flow->undersize_in_overflow = (double)NAN;
    if (!status && (!retained || !flow)) status = SCREEN_BAD_POINTER;
    if (!status && (places < 1 || !screen__good_duty(duty))) status = SCREEN_BAD_ARGUMENT;
    double *place = status ? NULL : (double *)screen__take(&def->memory, (size_t)places, sizeof(double));
    if (!status && !place) status = SCREEN_NO_MEMORY;
    if (!status) {
        const screen_def slice = screen__slice(def, duty);
        for (int j = 0; j < places; j++)
            place[j] = duty->length * (j + 1.0) / places / (def->continuous ? 1.0 : duty->velocity);
        status = screen_predict(&slice, model, parameters, operation, places, place, retained, NULL, NULL);
        if (!status || status == SCREEN_OUTSIDE) screen__sum_flow(&slice, duty, places, retained, depth, passed, flow);
    }
    if (place) screen__release(&def->memory, place, (size_t)places, sizeof(double));
    size_t rows = places > 0 ? (size_t)places : 0;
    screen__leave(status, rows, depth);
    screen__leave(status, screen__size(def, 1), passed);
    return screen__leave(status, screen__size(def, places), retained);
}

SCREEN_API screen_status screen_capacity(const screen_def *def, screen_model model, const double *parameters,
                                         const screen_operation *operation, const screen_duty *duty, double efficiency,
                                         double *feed) {
    if (!feed) return SCREEN_BAD_POINTER;
    *feed = (double)NAN;
    screen_status status = screen_check_def(def, NULL);
    if (status) return status;
    if (!duty || !(efficiency > 0.0 && efficiency < 1.0)) return SCREEN_BAD_ARGUMENT;
    if (def->load_exponent == 0.0 && model != SCREEN_SOLDINGER) return SCREEN_LOAD_UNKNOWN;
    double *retained = (double *)screen__take(&def->memory, (size_t)def->classes, sizeof(double));
    if (!retained) return SCREEN_NO_MEMORY;
    screen_duty one = *duty;
    screen_flow flow;
    double low = riddle_log(1e-6), high = riddle_log(1e6), reached = (double)NAN, first = 0.0, last = 0.0;
    for (int i = -2; i < 40; i++) { /* first both ends, then halves */
        double at = i == -2 ? low : i == -1 ? high : 0.5 * (low + high);
        one.feed = riddle_exp(at) * one.width * one.velocity;
        status = screen_steady(def, model, parameters, operation, &one, 1, retained, NULL, NULL, &flow);
        if (status && status != SCREEN_OUTSIDE) break;
        if (i == -2) first = flow.efficiency;
        if (i == -1) last = flow.efficiency;
        if (i == -1 && !(first - last > 1e-6)) status = SCREEN_LOAD_UNKNOWN;
        if (i == -1 && status != SCREEN_LOAD_UNKNOWN && !(first >= efficiency && last < efficiency))
            status = SCREEN_NOT_REACHED;
        if (status && status != SCREEN_OUTSIDE) break;
        if (i < 0) continue;
        if (flow.efficiency >= efficiency) low = at;
        else high = at;
        reached = one.feed;
    }
    screen__release(&def->memory, retained, (size_t)def->classes, sizeof(double));
    if (!status || status == SCREEN_OUTSIDE) *feed = reached;
    return status;
}

#endif /* SCREEN__BODIES */

#ifdef __cplusplus
}
#endif
#endif /* SCREEN_MODELS_H */
