/* classifier.h: air classification in a deflector wheel: drag of non-spherical particles, cut sizes, collision cases,
   separation curves.

   #include <stdio.h>
   #include "classifier.h"

   int main(void) {
       // edit any field: all are documented below
       classifier_def def = classifier_paper_def(CLASSIFIER_LIMESTONE, 9000.0, NULL);
       classifier_model model;
       if (classifier_init(&model, &def, NULL) != CLASSIFIER_OK) return 1;             // draws the sample points once
       // share of 20 um particles that is rejected
       double error, t = classifier_tromp(&model, 20e-6, &error);
       printf("T(20 um) = %.4f +- %.4f, x50 = %.2f um\n", t, error, 1e6 * classifier_quantile(&model, 0.5));
       classifier_free(&model);
   }

   Laws (pure functions; NaN outside their domain)
     drag          Hoelzer & Sommerfeld 2008, Schiller & Naumann 1933, Stokes; Di Felice 1994 for dense flow;
                   Rorato 2019 sphericity
     balance       cut size, threshold velocity, radial velocity for a wanted cut; terminal velocity; stopping distance
                   in closed form
     rebound       paddle and particle hits (Weers et al. 2022), Thornton & Ning 1998 restitution
     cases         weights of "one clean hit", "thrown by a particle", "hit again" for any number of contacts
     curves        Plitt, Molerus-Hoffmann, Rosin-Rammler with exact inverses; bypass and fish-hook
   Drivers (loops that call laws; return a status)
     classifier_init ...        the separation model of Weers et al., Minerals 12 (2022) 480, "the paper": T(x) with an
                                error bar
     classifier_trajectory ...  the same rebound followed along its path: the check of the balance at the instant of
                                the hit
     classifier_calibrate       one measured cut size
     classifier_for             speed and air for a wanted size and yield of the fine product
     classifier_fit             a curve to measured T(x)
     classifier_reconcile       T(x) from measured size distributions of feed, coarse and fine
     classifier_circuit         several stages with recycle

   Units    SI, angles [rad]; rotor speed [1/min], as every machine shows it. Size x [m]: diameter of the sphere of
            equal volume.
   Signs    radial velocity of gas and entering particles inward; tangential velocity of an entering particle against
            the wheel, after the hit with it. T is the share that is rejected to the coarse product.
   Errors   a function that returns a status leaves NaN in its outputs if that is not CLASSIFIER_OK; but a distribution
            (classifier_histogram) or a definition (classifier_calibrate) then stays as it was.
   Memory   one block a model (1 MB by default), made in classifier_init through a hook, freed in classifier_free.
            Nothing else allocates.
   Threads  no globals; a model that nobody changes may be read by any number of threads.
   Bits     + - * / sqrt and the portable block below: the same on every machine with -ffp-contract=off. Random shifts
            come from def.seed.
   Linking  static inline. One shared copy: #define CLASSIFIER_API extern everywhere, CLASSIFIER_IMPLEMENTATION as well
            in one file.
   Not here the gas flow between the paddles (its factor is an input), dispersion, wear. Sources and errata:
   docs/classifier.md. */
#ifndef CLASSIFIER_H
#define CLASSIFIER_H

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "classifier.h needs NaN and infinity: compile without -ffast-math"
#endif

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifndef CLASSIFIER_API
#define CLASSIFIER_API static inline
#define CLASSIFIER__BODIES
#elif defined(CLASSIFIER_IMPLEMENTATION)
#define CLASSIFIER__BODIES
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* =============================================== statuses and flags =============================================== */

#define CLASSIFIER_STATUSES(X)                                                                                         \
    X(CLASSIFIER_OK, "ok")                                                                                             \
    X(CLASSIFIER_BAD_ARGUMENT, "an argument is not a number, has the wrong sign, or is NULL")                          \
    X(CLASSIFIER_BAD_DEFINITION, "a field of the definition is out of range (classifier_check_def names it)")          \
    X(CLASSIFIER_EMPTY, "a distribution or table has no classes or no mass")                                           \
    X(CLASSIFIER_NOT_NORMALISED, "the shares of a distribution do not add up to 1 within 1e-3")                        \
    X(CLASSIFIER_NOT_SORTED, "sizes or class limits do not increase")                                                  \
    X(CLASSIFIER_OUTSIDE, "the wanted value lies outside the range that can be reached")                               \
    X(CLASSIFIER_NO_OUTLET, "a circuit lets nothing out")                                                              \
    X(CLASSIFIER_OUT_OF_MEMORY, "out of memory")                                                                       \
    X(CLASSIFIER_TOO_FEW, "a fit needs more distinct sizes than free parameters: the points leave the parameters "     \
                          "open")
#define CLASSIFIER__NAME(name, text) name,
typedef enum { CLASSIFIER_STATUSES(CLASSIFIER__NAME) CLASSIFIER__STATUS_COUNT } classifier_status;
#undef CLASSIFIER__NAME
static inline const char *classifier_status_text(classifier_status status);

/* Reservations about a result; bits of classifier_result.flags. */
enum {
    CLASSIFIER_SPHERICITY_CLAMPED = 1, /* a drawn 2D sphericity left the range of the conversion and was
                                          set to its end */
    CLASSIFIER_CUT_OUTSIDE = 2,        /* x25, x50 or x75 lies outside [size_low, size_high]: it is NaN */
    CLASSIFIER_MISSED = 4,             /* some drawn particles pass between the paddles untouched (they
                                          count as fine) */
    CLASSIFIER_EXTRAPOLATED = 8,       /* paper_def: the speed is outside the measured 3000 .. 15000 1/min; the values
                                          at the ends were used */
    CLASSIFIER_REYNOLDS_OUTSIDE = 16   /* Schiller-Naumann above Re 1000 at x75, or Stokes above Re 0.1 */
};

/* The allocator hook. NULL in place of it: realloc and free. new_size 0 frees and returns NULL; a failed growth leaves
   old as it was. */
typedef struct classifier_memory {
    void *(*fn)(void *user, void *old, size_t old_size, size_t new_size);
    void *user;
} classifier_memory;

/* ====================================================== drag ====================================================== */

/* Area that a drag coefficient is multiplied with. Hoelzer & Sommerfeld's belongs to the volume-equivalent sphere, pi
   x^2 / 4. The paper's eqs 6 and 10 multiply it with the projected area (pi x^2 / 4) / sphericity, which counts the
   shape twice: cuts 13-16 % too coarse. */
typedef enum { CLASSIFIER_EQUIVALENT, CLASSIFIER_PROJECTED } classifier_basis;
typedef enum { CLASSIFIER_HOELZER_SOMMERFELD, CLASSIFIER_SCHILLER_NAUMANN, CLASSIFIER_STOKES } classifier_drag_law;

/* A drag law with its shape worked in: c_D(Re) = c1 / Re + c2 / Re^p + c3, p = 0.5 or, for Schiller-Naumann, 0.313.
   Referred to pi x^2 / 4. Made once a shape; evaluating it needs no power. Any NaN in it comes from a sphericity
   outside (0, 1]. */
typedef struct classifier_drag {
    double c1, c2, c3; /* [-] */
    classifier_drag_law law;
} classifier_drag;

/* Returns 10^(0.4 (-log10 psi)^0.2), the factor of Hoelzer & Sommerfeld's Newton term. psi: sphericity in (0, 1].
   Infinitely steep at psi =
   1. */
static inline double classifier_newton_factor(double psi);
/* Returns the law of Hoelzer & Sommerfeld 2008 (eq 4) for the mean over all orientations of a convex body, where the
   three sphericities are one (Cauchy). psi: area of the volume-equivalent sphere / surface, in (0, 1] (rounding up
   to 1e-12 above is taken as 1). */
static inline classifier_drag classifier_hoelzer_sommerfeld(double psi, classifier_basis basis);
/* Returns the same in one orientation. psi_parallel: (pi x^2 / 4) / (surface / 2 - mean longitudinal projected area);
   psi_perpendicular: (pi x^2 / 4) / area across the flow. Both > 0. */
static inline classifier_drag classifier_hoelzer_sommerfeld_oriented(double psi, double psi_parallel,
                                                                     double psi_perpendicular, classifier_basis basis);
/* Returns the law of Schiller & Naumann 1933, spheres: 24/Re (1 + 0.15 Re^0.687) to Re = 1000, 0.44 above. Better than
   Hoelzer-Sommerfeld for psi >= 0.995, where that is 9-14 % low between Re 10 and 100. */
static inline classifier_drag classifier_schiller_naumann(void);
static inline classifier_drag classifier_stokes(void); /* 24/Re */
/* Returns c_D [-] at re > 0 (infinity allowed). */
static inline double classifier_drag_coefficient(classifier_drag drag, double re);
/* Returns the magnitude of the drag [N] at a slip speed [m/s] >= 0, for size x [m], fluid density [kg/m3],
   viscosity [Pa s]. Exact at 0. */
static inline double classifier_drag_force(classifier_drag drag, double x, double speed, double fluid_density,
                                           double viscosity);

/* Returns pi^(1/3) (6 V)^(2/3) / S: sphericity of a body of volume [m3] and surface [m2]. */
static inline double classifier_sphericity(double volume, double surface);
/* Returns 2 sqrt(pi A) / P: 2D sphericity of a projection of area [m2] and perimeter [m]. */
static inline double classifier_sphericity_2d(double area, double perimeter);
/* Returns the sphericity by Rorato et al. 2019 (eq 5): 1.075 psi_2d - 0.067 for 0.53442 <= psi_2d <= 0.99237; NaN
   outside (at 1 it would give 1.008). */
static inline double classifier_rorato(double psi_2d);
/* Returns the same with psi_2d moved into the range first; *clamped (may be NULL) : whether that was needed.
   NaN stays NaN. */
static inline double classifier_rorato_clamped(double psi_2d, bool *clamped);

/* Returns the exponent chi(Re) of Di Felice 1994 (eq 11), Re = fluid density * superficial slip * x / viscosity >= 0;
   minimum 3.05 at Re 31.6. */
static inline double classifier_di_felice_exponent(double re);
/* Returns the factor on the drag of a lone particle at a void fraction in (0, 1], named by the velocity that c_D v^2 is
   taken with. Superficial slip (= voids * interstitial): voids^-chi. */
static inline double classifier_di_felice_superficial(double voids, double re);
/* Returns the factor with the interstitial slip, for the drag alone: voids^(2 - chi). */
static inline double classifier_di_felice_interstitial_drag(double voids, double re);
/* Returns the factor with the interstitial slip, for drag and pressure gradient in one (eq 10): voids^(1 - chi). Do not
   add -V grad p to it. */
static inline double classifier_di_felice_interstitial_total(double voids, double re);

/* ==================================================== balance ===================================================== */

/* A particle in the curved flow of a wheel: centrifugal force outward, drag of the radial gas flow inward.
   All > 0 and finite. */
typedef struct classifier_balance {
    double fluid_density;       /* [kg/m3] */
    double viscosity;           /* [Pa s] */
    double particle_density;    /* [kg/m3] */
    double radius;              /* of the particle's place [m] */
    double radial_velocity;     /* of the gas, inward [m/s]; not used where it is the unknown */
    double tangential_velocity; /* of the particle [m/s]; not used where it is the unknown */
    bool buoyancy; /* true: particle_density - fluid_density drives (the gas turns with the particle); default false,
                      as the paper */
} classifier_balance;

/* Returns the cut size of spheres in Stokes flow [m], eq 3: sqrt(18 viscosity radius v_rad / (rho v_phi^2)). */
static inline double classifier_cut_size_stokes(const classifier_balance *at);
/* Returns the one size [m] at which both forces are equal, eq 6: x = K c_D(a x). iterations may be NULL; at most 6.
   Solves a quartic in sqrt(x) with one positive root (Descartes) by Newton's method from above; for Schiller-Naumann,
   uses Newton's method in ln x. NaN for bad input. */
static inline double classifier_cut_size(const classifier_balance *at, classifier_drag drag, int *iterations);
/* Returns d ln x / d ln K = 1 / (1 + m) at the cut, K ~ radius v_rad^2 / (rho v_phi^2): from 1/2 (Stokes)
   to 1 (Newton). */
static inline double classifier_cut_sensitivity(classifier_drag drag, double re);
/* Returns the tangential velocity [m/s] from which on size x [m] is rejected. Explicit: separation curves
   need no root. */
static inline double classifier_threshold_velocity(const classifier_balance *at, classifier_drag drag, double x);
/* Returns the radial gas velocity [m/s] that makes x the cut size. */
static inline double classifier_cut_radial_velocity(const classifier_balance *at, classifier_drag drag, double x);
/* Returns the settling velocity [m/s] of size x at rest under gravity [m/s2] > 0; negative if the particle rises. Any
   shape that drag describes. */
static inline double classifier_terminal_velocity(classifier_drag drag, double x, double particle_density,
                                                  double fluid_density, double viscosity, double gravity);
/* Returns the path [m] of a particle shot into gas at rest with speed [m/s] >= 0, closed form for any Reynolds number:
   (4 rho x / 3 rho_f) int_0^Re dRe / (Re c_D). Stokes number = this / length. */
static inline double classifier_stopping_distance(classifier_drag drag, double x, double particle_density,
                                                  double fluid_density, double viscosity, double speed);
/* Returns the stopping distance of spheres by the handbook formula, Mercer 1973 (Hinds eq 5.20), 1 < Re < 400: (rho
   x / rho_f) (Re^(1/3) - sqrt6 atan(Re^(1/3) / sqrt6)). */
static inline double classifier_stopping_distance_mercer(double x, double particle_density, double fluid_density,
                                                         double viscosity, double speed);

/* ==================================================== rebound ===================================================== */

/* Returns the restitution of an elastic-perfectly plastic sphere at normal speed [m/s] > 0 by Thornton & Ning 1998; 1
   up to the yield velocity [m/s]. */
static inline double classifier_thornton_ning(double speed, double yield_velocity);
/* Returns the yield velocity of a sphere on a plane, 1.5605 sqrt(p^5 / (rho E*^4)) [m/s]; contact_pressure: limiting
   contact pressure [Pa] (1.6 to 2.8 yield stresses). */
static inline double classifier_yield_velocity(double contact_pressure, double density, double reduced_modulus);
/* Returns E* [Pa] of two materials: 1 / ((1 - nu1^2) / E1 + (1 - nu2^2) / E2). */
static inline double classifier_reduced_modulus(double modulus_1, double poisson_1, double modulus_2, double poisson_2);

/* Returns the velocity after a normal hit on a paddle of speed v_w by a particle with the opposite velocity v_i:
   v_w + e (v_w + v_i), in the direction of the wheel [m/s]. */
static inline double classifier_rebound_normal(double paddle_speed, double e, double approach_speed);
/* Returns the tangential velocity after a hit at radius r: omega r + e |v_rel| cos(theta), theta: angle of the rebound
   to the face's normal, specular + imperfection. */
static inline double classifier_rebound_paddle(double paddle_speed, double e, double relative_speed, double cos_angle);
/* Returns the velocity of the thrown one (case B) of two equal particles, one of which leaves the wheel with v_a, while
   the other moves against it with v_t: -v_t + k share (v_a + v_t), k = (1 + e) / 2, share = cos(alpha), or cos^2(alpha)
   if the impulse follows the line of centres. */
static inline double classifier_rebound_thrown(double v_a, double v_t, double e, double share);
/* Returns the velocity of the other one (case C): v_a - k share (v_a + v_t). The paper's share is 1; conservation of
   momentum requires cos^2(alpha), as for the thrown one. */
static inline double classifier_rebound_slowed(double v_a, double v_t, double e, double share);

/* ================================================ collision cases ================================================= */

/* Shares of the three histories; they add up to 1. */
typedef struct classifier_weights {
    double clean;  /* A: one hit on a paddle, nothing else turned it round */
    double thrown; /* B: thrown outward by another particle at last */
    double again;  /* C: turned round by a particle, then hit by a paddle at last */
} classifier_weights;

/* Returns the weights for n >= 0 contacts with particles, if all possible sequences are equally likely (Fig 12 b):
   (n+1) 3^(1-n) / 4, 1/4, rest. NaN for n < 0. */
static inline classifier_weights classifier_weights_of(int n);
static inline classifier_weights classifier_weights_poisson(double mean);   /* mixed over a Poisson number, mean >= 0 */
/* Mixed over P(n) = (1 - q) q^n, q = mean / (1 + mean). */
static inline classifier_weights classifier_weights_geometric(double mean);
/* Returns the weights of a Markov chain, an extension of the equally likely sequences. counter: probability that a
   contact turns the particle round; wall: probability that it hits the paddle whenever it can. Both in [0, 1], wall or
   counter > 0. Not equal to weights_of
   for (1/2, 1/2), which counts forced steps once. */
static inline classifier_weights classifier_weights_markov(int n, double counter, double wall);

/* ================================================= distributions ================================================== */

enum { CLASSIFIER_BINS = 64 };
typedef enum { CLASSIFIER_NORMAL, CLASSIFIER_HISTOGRAM } classifier_shape;

/* One measured quantity. A normal law cut off at [low, high] (mean and sd are those before the cut; sd 0: always the
   mean), or a histogram. Owns no memory. */
typedef struct classifier_distribution {
    classifier_shape shape;
    double mean, sd, low, high;             /* in the unit of the quantity; of a histogram sd is 0 and not read */
    int bins;                               /* histogram: 1 .. CLASSIFIER_BINS */
    double edge[CLASSIFIER_BINS + 1];       /* increasing */
    double cumulative[CLASSIFIER_BINS + 1]; /* 0 .. 1 */
} classifier_distribution;

/* low, high may be infinite */
static inline classifier_distribution classifier_normal(double mean, double sd, double low, double high);
/* Makes a histogram from class limits edge[bins + 1] and shares[bins] that add up to 1 (within 1e-3, then exactly).
   *made stays as it was on an error: CLASSIFIER_EMPTY, _NOT_NORMALISED, _NOT_SORTED, _BAD_ARGUMENT (not finite,
   negative, more than CLASSIFIER_BINS). */
CLASSIFIER_API classifier_status classifier_histogram(const double *edge, const double *shares, int bins,
                                                      classifier_distribution *made);
CLASSIFIER_API classifier_status classifier_check_distribution(const classifier_distribution *d);
/* Return P(X >= value), and the inverse of P(X < value), u in (0, 1); NaN for what classifier_check_distribution
   refuses. */
CLASSIFIER_API double classifier_distribution_above(const classifier_distribution *d, double value);
CLASSIFIER_API double classifier_distribution_at(const classifier_distribution *d, double u);
CLASSIFIER_API double classifier_distribution_mean(const classifier_distribution *d); /* after the cut */

/* How often a particle meets others between the paddles. */
typedef enum {
    CLASSIFIER_FIXED,
    CLASSIFIER_POISSON,
    CLASSIFIER_GEOMETRIC,
    CLASSIFIER_COUNTED,
    CLASSIFIER_MARKOV
} classifier_contact_law;
typedef struct classifier_contacts {
    classifier_contact_law law;
    double mean;                   /* FIXED, MARKOV: the number (whole); POISSON, GEOMETRIC: the mean; >= 0 */
    int counts;                    /* COUNTED: length of share */
    double share[CLASSIFIER_BINS]; /* COUNTED: share of particles with 0, 1, ... contacts; adds up to 1 within 1e-3 */
    double counter, wall;          /* MARKOV */
} classifier_contacts;
CLASSIFIER_API classifier_status classifier_contact_weights(const classifier_contacts *contacts,
                                                            classifier_weights *weights);

/* ================================================ separation model ================================================ */

typedef struct classifier_wheel {
    double outer_radius, inner_radius, height; /* [m], outer > inner > 0, height > 0 */
    int paddles;                               /* >= 1 */
    double thickness;                          /* of a paddle [m] >= 0; their sum is less than the inner
                                                  circumference */
} classifier_wheel;

/* Returns the undisturbed inward gas velocity [m/s] at radius r: air flow / (height (2 pi r - paddles thickness)). */
static inline double classifier_radial_velocity(const classifier_wheel *wheel, double air_flow, double r);

/* The exact straight flight of a particle from the rim to the face of the next paddle, in the inertial frame. */
typedef struct classifier_impact {
    bool hit;       /* false: it stays clear of the face for a whole turn (or crosses the inner radius before) */
    double radius;  /* of the hit [m], at most outer_radius: one that has drifted out over the rim again meets the
                       face's plane there and counts as hit at the edge, not as let through */
    double time;    /* from the entry [s] */
    double speed;   /* relative to the paddle [m/s] */
    double angle;   /* between relative velocity and the face's normal, negative: sliding inward [rad] */
    int iterations; /* of Newton's method */
} classifier_impact;
/* Computes the straight flight to the next paddle. angular_speed of the wheel [rad/s]; ahead: angle of the entry before
   the paddle's middle line [rad]; velocities of the particle [m/s]. */
CLASSIFIER_API classifier_impact classifier_approach(const classifier_wheel *wheel, double angular_speed, double ahead,
                                                     double tangential_against, double radial_inward);

struct classifier_def;
/* Computes the same for a particle of size x [m] > 0 that the gas deflects. The gas is that of classifier_trajectory:
   it turns with the wheel and flows inward with radial_factor times the undisturbed velocity. hit is false for bad
   arguments. */
CLASSIFIER_API classifier_impact classifier_approach_in_gas(const struct classifier_def *def, classifier_drag drag,
                                                            double x, double ahead, double tangential_against,
                                                            double radial_inward);

typedef enum { CLASSIFIER_LATTICE, CLASSIFIER_SOBOL, CLASSIFIER_MONTE_CARLO } classifier_sampler;
enum { CLASSIFIER_MAX_SHIFTS = 64 };

/* The definition of the model. "paper": number in the text of Weers et al. 2022; "stand-in": only drawn in a figure or
   not given there, replaced by us (docs/classifier.md); defaults are limestone at 3000 1/min. Zero is
   never "default". */
typedef struct classifier_def {
    unsigned cookie;         /* set by classifier_default_def */
    classifier_wheel wheel;  /* 25 mm (paper), 18, 26.90 mm, 24, 2 mm (stand-ins: they give the paper's two
                                gas velocities) */
    double rpm;              /* rotor speed [1/min], above 0 to 1e9; 3000 */
    double air_flow;         /* [m3/s] > 0; 75 m3/h (paper) */
    double fluid_density;    /* [kg/m3] > 0; 1.2 */
    double viscosity;        /* [Pa s] > 0; 1.81e-5 */
    double particle_density; /* [kg/m3] > 0; 2700 (paper; glass 2500, stand-in) */
    double radial_factor;    /* gas velocity before the face / undisturbed [-] > 0; 2.7, 4.1, 4.3 at 3000, 9000, 15000
                                1/min (paper) */
    classifier_distribution tangential_velocity; /* of entering particles, against the wheel [m/s]; N(1.5 / 0 / 0, 1)
                                                    (stand-in, Fig 6) */
    classifier_distribution radial_velocity;     /* inward [m/s] >= 0; mean 1.0 (rpm / 3000)^0.9372, sd half of it
                                                    (stand-in, Fig 6) */
    classifier_distribution restitution;   /* particle on paddle, within [0, 1]; N(0.29, 0.15), beads N(0.75, 0.12)
                                              (stand-in, Fig 9) */
    classifier_distribution imperfection;  /* rebound angle - impact angle [rad]; sd 37, glass 42, beads 22 degrees
                                              (paper, Fig 7) */
    classifier_distribution sphericity_2d; /* N(0.83, 0.04), glass N(0.80, 0.04), beads N(0.98, 0.005)
                                              (stand-in, Fig 2) */
    bool sphericity_is_3d;                 /* true: sphericity_2d holds 3D sphericities in (0, 1] and eq 5 is
                                              left out; false */
    classifier_contacts contacts;          /* geometric, mean 1.0, beads 0.2 (stand-in, Fig 11) */
    double particle_restitution;           /* particle on particle, in [0, 1]; mean of restitution (paper) */
    double cone_half_angle;                /* of the directions after a particle hit [rad], in [0, pi/2]; 65
                                              degrees (paper) */
    bool impulse_along_centres;            /* cos^2 in place of cos in case B and of 1 in case C; false (paper) */
    classifier_drag_law law;               /* CLASSIFIER_HOELZER_SOMMERFELD; the two others ignore the sphericity */
    classifier_basis basis;                /* CLASSIFIER_EQUIVALENT; the paper: CLASSIFIER_PROJECTED */
    bool buoyancy;                         /* false */
    double size_low, size_high;            /* [m] range in which cut sizes are searched; 1e-7, 1e-2 */
    classifier_sampler sampler;            /* CLASSIFIER_LATTICE */
    bool preintegrate;    /* true (default): the last restitution is integrated in closed form; false: drawn, rejected
                             particles counted */
    int points;           /* drawn particles of a shift, a power of two from 16 to 2^20; 1024 */
    int shifts;           /* independent repetitions for the error bar, 2 .. CLASSIFIER_MAX_SHIFTS; 8 */
    uint64_t seed;        /* of the shifts; 1 */
    double approach_size; /* [m] >= 0: before the hit, gas deflects all particles as it does those of this size; 0
                             (paper): straight paths; 0 */
} classifier_def;

typedef enum { CLASSIFIER_LIMESTONE, CLASSIFIER_GROUND_GLASS, CLASSIFIER_BEADS } classifier_material;

CLASSIFIER_API classifier_def classifier_default_def(void);
/* Returns the paper's machine with one of its materials at a speed [1/min]; flags may be NULL:
   CLASSIFIER_EXTRAPOLATED. */
CLASSIFIER_API classifier_def classifier_paper_def(classifier_material material, double rpm, unsigned *flags);
/* Returns CLASSIFIER_OK, or the status of the first bad field, and its name in *field (a constant string; field
   may be NULL). */
CLASSIFIER_API classifier_status classifier_check_def(const classifier_def *def, const char **field);

/* The drawn particles, from which T follows at any size: 15 numbers a point. Fields may be read; `weights` may be
   changed (classifier_weights_of(2) shows the curve of exactly two contacts). */
typedef struct classifier_model {
    classifier_def def;
    classifier_weights weights;
    unsigned flags;
    double clamped, missed; /* shares of the drawn particles */
    double mean_radius;     /* of the first hit [m] */
    classifier_memory memory;
    int count;     /* points * shifts */
    double *data;  /* [count][15], see classifier__store */
    bool smooth;   /* the restitution is a normal law: its survival stands in the table */
    double *table; /* [512][6], quintic pieces */
    double table_low, table_scale;
} classifier_model;

/* Checks def and draws the points. A model in use must be freed first. memory may be NULL. On an error model is empty
   and may be freed. CLASSIFIER_OUTSIDE if approach_size is so small that a flight to the face would
   take 10 000 steps. */
CLASSIFIER_API classifier_status classifier_init(classifier_model *model, const classifier_def *def,
                                                 const classifier_memory *memory);
CLASSIFIER_API void classifier_free(classifier_model *model);
/* Returns the share of size x [m] > 0 that is rejected. error (may be NULL): half width of the 95 % interval from the
   shifts (Student). NaN for bad x. */
CLASSIFIER_API double classifier_tromp(const classifier_model *model, double x, double *error);
CLASSIFIER_API void classifier_tromp_cases(const classifier_model *model, double x, double t[3]); /* of A, B, C alone */
/* Returns the size [m] with T = t in (0, 1), to 1e-12 on the model's own points; NaN if there is none in
   [size_low, size_high]. */
CLASSIFIER_API double classifier_quantile(const classifier_model *model, double t);
/* Finds the same with drag before the hit, classifier_approach_in_gas, for particles of just the size that is found:
   def->approach_size is not read. case_weights (may be NULL) stands for the weights of the cases, such as {1, 0, 0}.
   NaN, CLASSIFIER_OUTSIDE if there is none. */
CLASSIFIER_API classifier_status classifier_quantile_in_gas(const classifier_def *def, double t,
                                                            const classifier_weights *case_weights,
                                                            const classifier_memory *memory, double *x);

typedef struct classifier_result {
    double x25, x50, x75;    /* [m] */
    double sharpness;        /* x25 / x75 [-] */
    double ecart_probable;   /* (x75 - x25) / 2 [m] */
    double x50_error;        /* half width of the 95 % interval [m] */
    double t_error;          /* largest error of T at x25, x50, x75 and the requested sizes */
    double re25, re50, re75; /* Reynolds numbers with the gas velocity at the mean hit radius */
    classifier_weights weights;
    double clamped, missed; /* shares of the drawn particles */
    unsigned flags;
} classifier_result;
/* Computes T at n sizes x[n] [m] into t[n] (both may be NULL with n 0) and the characteristics of the curve. */
CLASSIFIER_API classifier_status classifier_separate(const classifier_model *model, const double *x, double *t, int n,
                                                     classifier_result *result);

/* Solves radial_factor so that the model's x50 is the measured one [m] (the paper's one-point calibration); *calibrated
   is def with it, and may be def itself. CLASSIFIER_OUTSIDE if 1e-3 .. 1e3 times def's factor cannot reach it. */
CLASSIFIER_API classifier_status classifier_calibrate(const classifier_def *def, double x50,
                                                      const classifier_memory *memory, classifier_def *calibrated);
/* Finds the air flow [m3/s], or the rotor speed [1/min], that makes x50 [m] the model's cut size with everything else
   as in def. Errors as above; speeds from 1 to 1e6 are tried. */
CLASSIFIER_API classifier_status classifier_air_flow_for(const classifier_def *def, double x50,
                                                         const classifier_memory *memory, double *air_flow);
CLASSIFIER_API classifier_status classifier_rpm_for(const classifier_def *def, double x50,
                                                    const classifier_memory *memory, double *rpm);

/* What a mill's owner wants: a fine product of this size from this feed, on a machine with these limits.
   Owns no memory. */
typedef struct classifier_wish {
    int classes;               /* of the feed, >= 1 */
    const double *edge, *feed; /* [classes + 1] sizes [m] rising from >= 0, [classes] mass shares >= 0 that add up
                                  to 1 within 1e-3 */
    double size;               /* [m] > 0: this share of the fine product is finer, */
    double share;              /* (0, 1): 0.97 for a d97, 0.5 for a d50 */
    double yield;              /* wanted mass of fine product / feed, (0, 1); NaN: as it comes with the
                                  air flow of def */
    double rpm_low, rpm_high;  /* limits of the machine [1/min], 0 < low <= high <= 1e9 */
    double air_low, air_high;  /* [m3/s], 0 < low <= high */
} classifier_wish;
typedef struct classifier_setting {
    double rpm, air_flow;              /* [1/min] [m3/s] */
    double size, yield;                /* reached [m] [-] */
    double x50;                        /* cut size there [m]; NaN if there is none */
    double yield_low, yield_high;      /* what can be had of that size within the limits; equal to yield where
                                          none is wanted */
    double size_by_rpm, size_by_air;   /* relative change of size by the relative change of speed, of air [-] */
    double yield_by_rpm, yield_by_air; /* change of yield by the relative change of speed, of air [-] */
} classifier_setting;
/* Finds speed and air flow that give the wanted size, and of all that do the one with the wanted yield; everything else
   as in def. CLASSIFIER_OUTSIDE if the limits do not allow the size (all NaN) or the yield (setting has the nearest).
   CLASSIFIER_BAD_ARGUMENT, _EMPTY, _NOT_NORMALISED, _NOT_SORTED for a bad wish. About 1 s; fewer
   def->points take less. */
CLASSIFIER_API classifier_status classifier_for(const classifier_def *def, const classifier_wish *wish,
                                                const classifier_memory *memory, classifier_setting *setting);

/* ---- the path after the hit ---- */
typedef enum { CLASSIFIER_RADIAL_SLIP, CLASSIFIER_FULL_SLIP } classifier_slip;
/* Follows one particle in the inertial frame from radius r with velocities v_radial (outward) and v_phi, in gas that
   turns with the wheel and flows inward with radial_factor times the undisturbed velocity, until it leaves over the rim
   (1) or the inner radius (0); -1 if neither happens within 10 turns and 100 000 steps. RADIAL_SLIP: only the radial
       velocity difference makes drag, as in the balance;
   FULL_SLIP: the whole vector. */
CLASSIFIER_API int classifier_trajectory(const classifier_def *def, classifier_drag drag, double x, double r,
                                         double v_radial, double v_phi, classifier_slip slip);
/* Returns the size [m] whose fate changes, for a start with v_radial = 0. NaN if none in [size_low, size_high]. */
CLASSIFIER_API double classifier_trajectory_cut(const classifier_def *def, classifier_drag drag, double r, double v_phi,
                                                classifier_slip slip);

/* Computes T at x [m] with every drawn particle followed along its path after the hit (start with v_radial = 0, as the
   balance sees it). Uses def's points and shifts with drawn restitutions; error as in classifier_tromp. About 10 us a
   particle and case: 64 to 512 points will do. Paths that stay are not rejected. CLASSIFIER_OUTSIDE if 100 000 steps do
   not follow a path to its end: particles that the gas takes along at once. */
CLASSIFIER_API classifier_status classifier_trajectory_tromp(const classifier_def *def, double x, classifier_slip slip,
                                                             double *t, double *error);

/* ===================================================== curves ===================================================== */

/* Return separation curves T(x) of sizes x [m] >= 0, and their inverses for t in [0, 1). */
static inline double classifier_plitt(double x, double x50, double m);         /* 1 - exp(-ln2 (x/x50)^m) */
static inline double classifier_plitt_size(double t, double x50, double m);    /* inverse */
static inline double classifier_rosin_rammler(double x, double x63, double n); /* 1 - exp(-(x/x63)^n) */
static inline double classifier_rosin_rammler_size(double t, double x63, double n);
/* Return 1 / (1 + (x50/x)^2 exp(alpha (1 - (x/x50)^2))), alpha >= 0, and its inverse by Lambert's W. */
static inline double classifier_molerus_hoffmann(double x, double x50, double alpha);
static inline double classifier_molerus_hoffmann_size(double t, double x50, double alpha);

typedef enum { CLASSIFIER_PLITT, CLASSIFIER_ROSIN_RAMMLER, CLASSIFIER_MOLERUS_HOFFMANN } classifier_curve_law;
typedef struct classifier_curve {
    classifier_curve_law law;
    double size;      /* x50 or x63 of the curve without bypass [m] > 0 */
    double slope;     /* m, n > 0 or alpha >= 0 */
    double bypass;    /* share that goes to the coarse product whatever its size, [0, 1); 0 */
    double hook_size; /* [m] > 0: the bypass falls linearly to 0 at this size (fish-hook, Finch 1983); infinity: the
                         same for all sizes */
} classifier_curve;
static inline classifier_curve classifier_curve_of(classifier_curve_law law, double size, double slope); /* no bypass */
/* b + (1 - b) T(x); x >= 0 */
static inline double classifier_curve_value(const classifier_curve *curve, double x);
/* Returns the largest size [m] with that value. NaN if there is none (t below the bypass). */
CLASSIFIER_API double classifier_curve_size(const classifier_curve *curve, double t);

/* Returns the mean of T over a class [low, high] [m] with mass density q(x) (NULL: uniform): int T q / int q,
   Gauss-Legendre on `pieces` >= 1 pieces of 5 points. */
typedef double (*classifier_function)(double x, const void *user);
CLASSIFIER_API double classifier_class_mean(classifier_function t, const void *t_user, classifier_function q,
                                            const void *q_user, double low, double high, int pieces);

/* bits; 0: size and slope, always free, alone. HOOK frees the bypass too */
enum { CLASSIFIER_FREE_BYPASS = 1, CLASSIFIER_FREE_HOOK = 2 };
enum { CLASSIFIER_SLOPE = 4 };                                 /* a bit of at_border */
typedef struct classifier_fit_result {
    classifier_curve curve;
    /* Standard deviations from the curvature; with sd NULL scaled by the residuals. 0 where a parameter is not free or
       stands at its border, infinite where the points leave it open. */
    double size_sd, slope_sd, bypass_sd, hook_sd;
    unsigned at_border; /* bits: FREE_BYPASS: the best bypass is 0; FREE_HOOK: the best curve has no hook (hook_size
                           infinite); SLOPE: the best alpha is 0 (Molerus & Hoffmann) */
    double rms;         /* of T [-] */
    double dof;         /* degrees of freedom: points minus parameters that are not at a border */
    double student; /* Student's t of dof, or 1.96 with sd given: a 95 % range of size and slope is value +-
                           student * sd; NaN with a free hook, whose deviations give no range */
    /* 95 % ranges from the profile of the sum of squares: they hold near a bypass of 0 and with a hook, too. hook_high
       infinite: the points are as well without a hook; hook_low 0: without a bypass. 0 to infinite (bypass 1): left
       open. Equal where not free. */
    double size_low, size_high, slope_low, slope_high, bypass_low, bypass_high, hook_low, hook_high;
    int iterations;
} classifier_fit_result;
/* Fits a curve by least squares (Levenberg-Marquardt in ln size, ln slope, logit bypass, ln hook) to n measured points
   x[n] [m] > 0, t[n]; sd[n] > 0, the largest at most 1e6 times the smallest, or NULL (all equal). A parameter whose
   best value lies at its border is fixed there and the others are fitted again; a hook is sought from between each two
   sizes. Needs more distinct sizes than free parameters (CLASSIFIER_TOO_FEW), values on both sides of one half (with a
   bypass: of the middle between it and 1), and T that rises with x so that no constant fits as well
   (CLASSIFIER_OUTSIDE: the points leave the cut size open). */
CLASSIFIER_API classifier_status classifier_fit(classifier_curve_law law, unsigned free_parameters, const double *x,
                                                const double *t, const double *sd, int n,
                                                classifier_fit_result *result);

/* Separation curve from three measured size distributions. Shares per class, each adding up to 1 within 1e-3. */
typedef struct classifier_balance_data {
    int classes;                                 /* >= 2 */
    const double *feed, *coarse, *fine;          /* [classes] >= 0 */
    const double *feed_sd, *coarse_sd, *fine_sd; /* [classes] > 0, standard deviations of the shares; the
                                                    caller's arrays */
    double coarse_share, coarse_share_sd;        /* measured mass of coarse / feed and its sd; NaN if not measured */
} classifier_balance_data;
typedef struct classifier_balance_result {
    double coarse_share, coarse_share_sd; /* reconciled, in (0, 1) */
    double chi_squared;                   /* sum of (adjustment / sd)^2: about `freedom` if the sds are honest */
    int freedom;
} classifier_balance_result;
/* Finds the least adjustment that makes feed = c coarse + (1 - c) fine hold in every class with all three still adding
   up to 1 and no share below 0 (T from 0 to 1); c with it.
   Outputs (caller's, [classes], each may be NULL): t and its sd (where T is 0 or 1 that of an unbounded T), the
   reconciled distributions. Classes without feed have t NaN. */
CLASSIFIER_API classifier_status classifier_reconcile(const classifier_balance_data *data, double *t, double *t_sd,
                                                      double *feed, double *coarse, double *fine,
                                                      classifier_balance_result *result);

/* Several classifiers with recycle. Stage i sends the share t of its feed to coarse_to[i] and the rest to fine_to[i]:
   another stage, or one of the two products. */
enum { CLASSIFIER_STAGES = 16, CLASSIFIER_TO_COARSE = -1, CLASSIFIER_TO_FINE = -2 };
typedef struct classifier_circuit_def {
    int stages; /* 1 .. CLASSIFIER_STAGES; fresh feed enters stage 0 */
    int coarse_to[CLASSIFIER_STAGES];
    int fine_to[CLASSIFIER_STAGES];
} classifier_circuit_def;
/* Computes one size class: t[stages] in [0, 1] -> share of the fresh feed in the coarse product, and load[stages] (may
   be NULL): flow into each stage / fresh feed. CLASSIFIER_NO_OUTLET if the flow never leaves. Several classes: call
   it for each. */
CLASSIFIER_API classifier_status classifier_circuit(const classifier_circuit_def *circuit, const double *t,
                                                    double *coarse, double *load);

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

/* >>laws =========================================================================================================== */

static inline const char *classifier_status_text(classifier_status status) {
#define CLASSIFIER__TEXT(name, text)                                                                                   \
    if (status == name) return text;
    CLASSIFIER_STATUSES(CLASSIFIER__TEXT)
#undef CLASSIFIER__TEXT
    return "unknown status";
}

static inline bool classifier__positive(double v) { return v > 0.0 && v < HUGE_VAL; }
static inline double classifier__nan(void) { return (double)NAN; }

/* Passes a status on; a failure leaves NaN in out [n] (may be NULL), so that it is not mistaken for a result. */
static inline classifier_status classifier__leave(classifier_status status, int n, double *out) {
    for (int i = 0; status != CLASSIFIER_OK && out && i < n; i++) out[i] = classifier__nan();
    return status;
}

static inline double classifier_newton_factor(double psi) {
    if (!(psi > 0.0 && psi <= 1.0 + 1e-12)) return classifier__nan();
    double ln10 = 2.302585092994046, l = psi < 1.0 ? -riddle_log(psi) / ln10 : 0.0;
    return riddle_exp(0.4 * ln10 * riddle_pow(l, 0.2));
}

static inline classifier_drag classifier_hoelzer_sommerfeld_oriented(double psi, double psi_parallel,
                                                                     double psi_perpendicular, classifier_basis basis) {
    classifier_drag d = {classifier__nan(), classifier__nan(), classifier__nan(), CLASSIFIER_HOELZER_SOMMERFELD};
    double factor = classifier_newton_factor(psi);
    if (!(factor > 0.0 && classifier__positive(psi_parallel) && classifier__positive(psi_perpendicular))) return d;
    double root = sqrt(psi), area = basis == CLASSIFIER_PROJECTED ? 1.0 / psi_perpendicular : 1.0;
    d.c1 = (8.0 / sqrt(psi_parallel) + 16.0 / root) * area;
    d.c2 = 3.0 / (root * sqrt(root)) * area;
    d.c3 = 0.42 * factor / psi_perpendicular * area;
    return d;
}

static inline classifier_drag classifier_hoelzer_sommerfeld(double psi, classifier_basis basis) {
    return classifier_hoelzer_sommerfeld_oriented(psi, psi, psi, basis);
}

static inline classifier_drag classifier_schiller_naumann(void) {
    classifier_drag d = {24.0, 3.6, 0.0, CLASSIFIER_SCHILLER_NAUMANN};
    return d;
}

static inline classifier_drag classifier_stokes(void) {
    classifier_drag d = {24.0, 0.0, 0.0, CLASSIFIER_STOKES};
    return d;
}

static inline double classifier_drag_coefficient(classifier_drag drag, double re) {
    if (!(re > 0.0)) return classifier__nan();
    if (drag.law == CLASSIFIER_SCHILLER_NAUMANN)
        return re <= 1000.0 ? drag.c1 / re + drag.c2 * riddle_pow(re, -0.313) : 0.44;
    return drag.c1 / re + drag.c2 / sqrt(re) + drag.c3;
}

static inline double classifier_drag_force(classifier_drag drag, double x, double speed, double fluid_density,
                                           double viscosity) {
    if (!(classifier__positive(x) && classifier__positive(fluid_density) && classifier__positive(viscosity) &&
          speed >= 0.0))
        return classifier__nan();
    double re = fluid_density * speed * x / viscosity;
    double cd_re = re > 0.0 ? classifier_drag_coefficient(drag, re) * re : drag.c1;
    return 0.125 * RIDDLE_PI * x * viscosity * speed * cd_re;
}

static inline double classifier_sphericity(double volume, double surface) {
    if (!(classifier__positive(volume) && classifier__positive(surface))) return classifier__nan();
    double d = riddle_cbrt(6.0 * volume / RIDDLE_PI);
    return RIDDLE_PI * d * d / surface;
}

static inline double classifier_sphericity_2d(double area, double perimeter) {
    if (!(classifier__positive(area) && classifier__positive(perimeter))) return classifier__nan();
    return 2.0 * sqrt(RIDDLE_PI * area) / perimeter;
}

#define CLASSIFIER__RORATO_LOW ((0.5075 + 0.067) / 1.075)
#define CLASSIFIER__RORATO_HIGH ((0.9998 + 0.067) / 1.075)

static inline double classifier_rorato(double psi_2d) {
    if (!(psi_2d >= CLASSIFIER__RORATO_LOW && psi_2d <= CLASSIFIER__RORATO_HIGH)) return classifier__nan();
    return 1.075 * psi_2d - 0.067;
}

static inline double classifier_rorato_clamped(double psi_2d, bool *clamped) {
    double inside = psi_2d < CLASSIFIER__RORATO_LOW    ? CLASSIFIER__RORATO_LOW
                    : psi_2d > CLASSIFIER__RORATO_HIGH ? CLASSIFIER__RORATO_HIGH
                                                       : psi_2d;
    if (clamped) *clamped = inside != psi_2d;
    return classifier_rorato(inside);
}

static inline double classifier_di_felice_exponent(double re) {
    if (!(re >= 0.0)) return classifier__nan();
    if (re == 0.0) return 3.7;
    double z = 1.5 - riddle_log(re) / 2.302585092994046;
    return 3.7 - 0.65 * riddle_exp(-0.5 * z * z);
}

static inline double classifier__voids_power(double voids, double exponent) {
    return voids > 0.0 && voids <= 1.0 ? riddle_pow(voids, exponent) : classifier__nan();
}
static inline double classifier_di_felice_superficial(double voids, double re) {
    return classifier__voids_power(voids, -classifier_di_felice_exponent(re));
}
static inline double classifier_di_felice_interstitial_drag(double voids, double re) {
    return classifier__voids_power(voids, 2.0 - classifier_di_felice_exponent(re));
}
static inline double classifier_di_felice_interstitial_total(double voids, double re) {
    return classifier__voids_power(voids, 1.0 - classifier_di_felice_exponent(re));
}

/* >>balance ======================================================================================================== */

/* Solves Re = g c_D(Re). In units of the largest of the three one-term solutions a quartic in y = sqrt(Re), y^4 - u3
   y^2 - u2 y - u1 = 0 with all u in [0, 1]: one positive root (Descartes), between 1 and sqrt 3, and for y >= 1
   slope >= y^3, so that Newton's method converges. The start takes sqrt(Re) of the middle term as 1. */
static inline double classifier__solve_cut(classifier_drag drag, double g, int *iterations) {
    double s1 = sqrt(g) * sqrt(drag.c1), s2 = riddle_cbrt(g * drag.c2), s3 = g * drag.c3;
    s2 *= s2;
    double unit = s1 > s2 ? s1 : s2;
    if (s3 > unit) unit = s3;
    double u3 = s3 / unit, u2 = s2 / unit * sqrt(s2 / unit), u1 = s1 / unit * (s1 / unit),
           y = sqrt(0.5 * u3 + sqrt(0.25 * u3 * u3 + u2 + u1));
    int i = 0;
    /* Quadratic: a step of 1e-9 leaves less than a rounding. */
    for (double step = 1.0; fabs(step) > 1e-9 && i < 20; i++) {
        step = (((y * y - u3) * y - u2) * y - u1) / ((4.0 * y * y - 2.0 * u3) * y - u2);
        y -= step;
    }
    if (iterations) *iterations = i;
    return unit * y * y;
}

/* Solves Re^2 c_D(Re) = b. In units of the smallest one-term solution, v3 y^4 + v2 y^3 + v1 y^2 = 1, which rises and is
   convex, with a root between 1/sqrt 3 and 1. */
static inline double classifier__solve_speed(classifier_drag drag, double b, int *iterations) {
    /* Infinite where a term is missing. */
    double s1 = b / drag.c1, s2 = riddle_cbrt(b / drag.c2), s3 = sqrt(b / drag.c3);
    s2 *= s2;
    double unit = s1 < s2 ? s1 : s2;
    if (s3 < unit) unit = s3;
    double v1 = unit / s1, v2 = unit / s2 * sqrt(unit / s2), v3 = unit / s3 * (unit / s3), y = 1.0;
    int i = 0;
    for (double step = 1.0; fabs(step) > 1e-9 && i < 20; i++) {
        step = (((v3 * y + v2) * y + v1) * y * y - 1.0) / (((4.0 * v3 * y + 3.0 * v2) * y + 2.0 * v1) * y);
        y -= step;
    }
    if (iterations) *iterations = i;
    return unit * y * y;
}

/* Solves Re^k c_D = b for Schiller-Naumann, k = -1 (cut) or 2 (speed), by Newton's method in ln Re; it converges
   monotonically because the slope k - m is monotone. */
static inline double classifier__solve_schiller_naumann(classifier_drag drag, double b, double k, int *iterations) {
    double ln_b = riddle_log(b), l = k < 0.0 ? -0.5 * (riddle_log(drag.c1) - ln_b) : ln_b - riddle_log(drag.c1);
    int i = 0;
    for (double step = 1.0; fabs(step) > 1e-9 && i < 40; i++) {
        double t1 = drag.c1 * riddle_exp(-l), t2 = drag.c2 * riddle_exp(-0.313 * l), m = (t1 + 0.313 * t2) / (t1 + t2);
        step =
            k < 0.0 ? (l - ln_b - riddle_log(t1 + t2)) / (1.0 + m) : (2.0 * l + riddle_log(t1 + t2) - ln_b) / (2.0 - m);
        l -= step;
    }
    if (iterations) *iterations = i;
    double re = riddle_exp(l);
    if (re <= 1000.0) return re;
    re = k < 0.0 ? 0.44 * b : sqrt(b / 0.44);
    return re > 1000.0 ? re : 1000.0; /* b falls into the law's 0.4 % step at Re 1000 */
}

static inline bool classifier__balance_ok(const classifier_balance *at) {
    return classifier__positive(at->fluid_density) && classifier__positive(at->viscosity) &&
           classifier__positive(at->particle_density) && classifier__positive(at->radius) &&
           (!at->buoyancy || at->particle_density > at->fluid_density);
}
static inline double classifier__driving_density(const classifier_balance *at) {
    return at->buoyancy ? at->particle_density - at->fluid_density : at->particle_density;
}
static inline bool classifier__drag_ok(classifier_drag drag) {
    return classifier__positive(drag.c1) && drag.c2 >= 0.0 && drag.c3 >= 0.0 && drag.c2 + drag.c3 < HUGE_VAL;
}

static inline double classifier_cut_size_stokes(const classifier_balance *at) {
    if (!(classifier__balance_ok(at) && classifier__positive(at->radial_velocity) &&
          classifier__positive(at->tangential_velocity)))
        return classifier__nan();
    return sqrt(18.0 * at->viscosity / classifier__driving_density(at) * at->radius * at->radial_velocity) /
           at->tangential_velocity;
}

static inline double classifier_cut_size(const classifier_balance *at, classifier_drag drag, int *iterations) {
    if (iterations) *iterations = 0;
    if (!(classifier__balance_ok(at) && classifier__positive(at->radial_velocity) &&
          classifier__positive(at->tangential_velocity) && classifier__drag_ok(drag)))
        return classifier__nan();
    double ratio = at->radial_velocity / at->tangential_velocity;
    double k = 0.75 * at->fluid_density / classifier__driving_density(at) * at->radius * ratio * ratio;
    double a = at->fluid_density * at->radial_velocity / at->viscosity; /* Re = a x */
    if (drag.law == CLASSIFIER_SCHILLER_NAUMANN)
        return classifier__solve_schiller_naumann(drag, a * k, -1.0, iterations) / a;
    return classifier__solve_cut(drag, a * k, iterations) / a;
}

static inline double classifier_cut_sensitivity(classifier_drag drag, double re) {
    if (!(re > 0.0 && classifier__drag_ok(drag))) return classifier__nan();
    double p = 0.5, t2 = drag.c2 / sqrt(re), t1 = drag.c1 / re;
    if (drag.law == CLASSIFIER_SCHILLER_NAUMANN) {
        if (re > 1000.0) return 1.0;
        p = 0.313;
        t2 = drag.c2 * riddle_pow(re, -p);
    }
    return 1.0 / (1.0 + (t1 + p * t2) / (t1 + t2 + drag.c3));
}

static inline double classifier_threshold_velocity(const classifier_balance *at, classifier_drag drag, double x) {
    if (!(classifier__balance_ok(at) && classifier__positive(at->radial_velocity) && classifier__positive(x)))
        return classifier__nan();
    double re = at->fluid_density * at->radial_velocity * x / at->viscosity;
    return at->radial_velocity * sqrt(0.75 * at->fluid_density / classifier__driving_density(at) * at->radius / x *
                                      classifier_drag_coefficient(drag, re));
}

/* Returns the speed at which the drag on x [m] balances density * acceleration. density: of the driving force. */
static inline double classifier__speed_for(classifier_drag drag, double x, double density, double fluid_density,
                                           double viscosity, double acceleration) {
    double unit = viscosity / (fluid_density * x); /* speed at Re = 1 */
    double b = 4.0 / 3.0 * density / fluid_density * acceleration * x / (unit * unit);
    if (!(classifier__positive(b) && classifier__drag_ok(drag))) return classifier__nan();
    if (drag.law == CLASSIFIER_SCHILLER_NAUMANN) return unit * classifier__solve_schiller_naumann(drag, b, 2.0, NULL);
    return unit * classifier__solve_speed(drag, b, NULL);
}

static inline double classifier_cut_radial_velocity(const classifier_balance *at, classifier_drag drag, double x) {
    if (!(classifier__balance_ok(at) && classifier__positive(at->tangential_velocity) && classifier__positive(x)))
        return classifier__nan();
    return classifier__speed_for(drag, x, classifier__driving_density(at), at->fluid_density, at->viscosity,
                                 at->tangential_velocity * at->tangential_velocity / at->radius);
}

static inline double classifier_terminal_velocity(classifier_drag drag, double x, double particle_density,
                                                  double fluid_density, double viscosity, double gravity) {
    if (!(classifier__positive(x) && particle_density >= 0.0 && classifier__positive(fluid_density) &&
          classifier__positive(viscosity) && classifier__positive(gravity)))
        return classifier__nan();
    double difference = particle_density - fluid_density;
    if (difference == 0.0) return 0.0;
    double v = classifier__speed_for(drag, x, fabs(difference), fluid_density, viscosity, gravity);
    return difference > 0.0 ? v : -v;
}

/* Returns int_0^re dRe / (Re c_D). With u = sqrt(Re) this is int 2 u du / (c1 + c2 u + c3 u^2). */
static inline double classifier__drag_integral(classifier_drag drag, double re) {
    double c1 = drag.c1, c2 = drag.c2, c3 = drag.c3, u = sqrt(re);
    if (drag.law == CLASSIFIER_SCHILLER_NAUMANN) {
        /* (Re/24) 2F1(1, b; 1 + b; -z), z = 0.15 Re^0.687, b = 1 / 0.687; Pfaff's transformation makes all
           terms positive */
        double low = re < 1000.0 ? re : 1000.0, z = c2 / c1 * riddle_pow(low, 0.687), w = z / (1.0 + z),
               b = 1.0 / 0.687, term = 1.0, sum = 0.0;
        for (int n = 1; term > 1e-17 * sum && n < 4000; n++) {
            sum += term;
            term *= w * n / (b + n);
        }
        return low / c1 / (1.0 + z) * sum + (re > low ? riddle_log(re / low) / 0.44 : 0.0);
    }
    if (c2 == 0.0 && c3 == 0.0) return re / c1;
    double small = (c2 * u + c3 * re) / c1;
    /* the closed form cancels here: 2 u / c1 times the power series of 1 / (1 + p + q), term by term */
    if (small < 0.2) {
        double p = c2 / c1 * u, q = c3 / c1 * re, before = 0.0, now = 1.0, sum = 0.0;
        for (int n = 0; n < 24; n++) {
            sum += now / (n + 2);
            double next = -p * now - q * before;
            before = now;
            now = next;
        }
        return 2.0 * re / c1 * sum;
    }
    double d = 4.0 * c1 * c3 - c2 * c2, rest;
    if (d > 0.0) {
        double root = sqrt(d);
        rest = 2.0 / root * riddle_atan2(root * u, 2.0 * c1 + c2 * u); /* difference of two arctangents in one */
    } else {
        double root = sqrt(-d), s = root * u / (2.0 * c1 + c2 * u);
        rest = s > 1e-4 ? riddle_log((1.0 + s) / (1.0 - s)) / root
                        : 2.0 * u / (2.0 * c1 + c2 * u) * (1.0 + s * s / 3.0 + s * s * s * s / 5.0);
    }
    return (riddle_log1p(small) - c2 * rest) / c3;
}

static inline double classifier_stopping_distance(classifier_drag drag, double x, double particle_density,
                                                  double fluid_density, double viscosity, double speed) {
    if (!(classifier__positive(x) && classifier__positive(particle_density) && classifier__positive(fluid_density) &&
          classifier__positive(viscosity) && speed >= 0.0 && speed < HUGE_VAL && classifier__drag_ok(drag)))
        return classifier__nan();
    if (speed == 0.0) return 0.0;
    return 4.0 / 3.0 * particle_density / fluid_density * x *
           classifier__drag_integral(drag, fluid_density * speed * x / viscosity);
}

static inline double classifier_stopping_distance_mercer(double x, double particle_density, double fluid_density,
                                                         double viscosity, double speed) {
    if (!(classifier__positive(x) && classifier__positive(particle_density) && classifier__positive(fluid_density) &&
          classifier__positive(viscosity) && speed >= 0.0))
        return classifier__nan();
    double root6 = 2.449489742783178, c = riddle_cbrt(fluid_density * speed * x / viscosity);
    return particle_density * x / fluid_density * (c - root6 * riddle_atan(c / root6));
}

/* >>rebound ======================================================================================================== */

static inline double classifier_thornton_ning(double speed, double yield_velocity) {
    if (!(classifier__positive(speed) && yield_velocity > 0.0)) return classifier__nan();
    double r = yield_velocity / speed;
    if (r >= 1.0) return 1.0;
    return sqrt(1.2 * 1.7320508075688773 * (1.0 - r * r / 6.0) * sqrt(r / (r + 2.0 * sqrt(1.2 - 0.2 * r * r))));
}

static inline double classifier_yield_velocity(double contact_pressure, double density, double reduced_modulus) {
    if (!(classifier__positive(contact_pressure) && classifier__positive(density) &&
          classifier__positive(reduced_modulus)))
        return classifier__nan();
    double ratio = contact_pressure / reduced_modulus;
    return 1.5605 * ratio * ratio * sqrt(contact_pressure / density);
}

static inline double classifier_reduced_modulus(double modulus_1, double poisson_1, double modulus_2,
                                                double poisson_2) {
    if (!(modulus_1 > 0.0 && modulus_2 > 0.0 && fabs(poisson_1) < 1.0 && fabs(poisson_2) < 1.0))
        return classifier__nan();
    return 1.0 / ((1.0 - poisson_1 * poisson_1) / modulus_1 + (1.0 - poisson_2 * poisson_2) / modulus_2);
}

static inline double classifier_rebound_normal(double paddle_speed, double e, double approach_speed) {
    return e >= 0.0 && e <= 1.0 ? paddle_speed + e * (paddle_speed + approach_speed) : classifier__nan();
}
static inline double classifier_rebound_paddle(double paddle_speed, double e, double relative_speed, double cos_angle) {
    return e >= 0.0 && e <= 1.0 ? paddle_speed + e * relative_speed * cos_angle : classifier__nan();
}
static inline double classifier_rebound_thrown(double v_a, double v_t, double e, double share) {
    return e >= 0.0 && e <= 1.0 ? 0.5 * (1.0 + e) * share * (v_a + v_t) - v_t : classifier__nan();
}
static inline double classifier_rebound_slowed(double v_a, double v_t, double e, double share) {
    return e >= 0.0 && e <= 1.0 ? v_a - 0.5 * (1.0 + e) * share * (v_a + v_t) : classifier__nan();
}

/* >>cases ========================================================================================================== */

static inline classifier_weights classifier__weights(double clean, double thrown, double again) {
    classifier_weights w;
    w.clean = clean;
    w.thrown = thrown;
    w.again = again;
    return w;
}
static inline classifier_weights classifier__weights_nan(void) {
    return classifier__weights(classifier__nan(), classifier__nan(), classifier__nan());
}

static inline classifier_weights classifier_weights_of(int n) {
    if (n < 0) return classifier__weights_nan();
    if (n == 0) return classifier__weights(1.0, 0.0, 0.0);
    double a = 0.75 * (n + 1.0);
    for (int i = 0; i < n && a > 0.0; i++) a /= 3.0;
    return classifier__weights(a, 0.25, 0.75 - a);
}

static inline classifier_weights classifier_weights_poisson(double mean) {
    if (!(mean >= 0.0)) return classifier__weights_nan();
    double b = -0.25 * riddle_expm1(-mean), zero = riddle_exp(-mean);
    double a = zero + 0.75 * ((1.0 + mean / 3.0) * riddle_exp(-2.0 / 3.0 * mean) - zero);
    if (!(mean < 1000.0)) a = 0.0;
    return classifier__weights(a, b, 1.0 - a - b);
}

static inline classifier_weights classifier_weights_geometric(double mean) {
    if (!(mean >= 0.0)) return classifier__weights_nan();
    double q = mean < 1e300 ? mean / (1.0 + mean) : 1.0, f = 1.0 - q / 3.0, a = (1.0 - q) * (0.25 + 0.75 / (f * f));
    return classifier__weights(a, 0.25 * q, 1.0 - a - 0.25 * q);
}

static inline classifier_weights classifier_weights_markov(int n, double counter, double wall) {
    if (!(n >= 0 && counter >= 0.0 && counter <= 1.0 && wall >= 0.0 && wall <= 1.0)) return classifier__weights_nan();
    /* Inbound; outbound with a paddle or a particle as the last reversal. */
    double in = 1.0 - wall, out_w = wall, out_p = 0.0;
    double clean_in = in, clean_out = wall;            /* of these: never turned by a particle */
    for (int i = 0; i < n; i++) {
        double turned_in = counter * (out_w + out_p), turned_out = counter * in;
        in = (1.0 - counter) * in + turned_in;
        out_p = (1.0 - counter) * out_p + turned_out;
        out_w *= 1.0 - counter;
        clean_in *= 1.0 - counter;
        clean_out *= 1.0 - counter;
        out_w += wall * in;
        in *= 1.0 - wall;
        clean_out += wall * clean_in;
        clean_in *= 1.0 - wall;
    }
    double out = out_w + out_p;
    if (!(out > 0.0)) return classifier__weights_nan();
    return classifier__weights(clean_out / out, out_p / out, (out_w - clean_out) / out);
}

/* >>curves ========================================================================================================= */

/* Solves w + ln w = l, which gives Lambert's W(e^l) without overflow, by Newton's method for a concave
   function, from below. */
static inline double classifier__lambert_w_exp(double l) {
    double w = l < 1.0 ? riddle_exp(l) / (1.0 + riddle_exp(l)) : l - riddle_log(l);
    for (int i = 0; i < 40 && w > 0.0; i++) {
        double step = (w + riddle_log(w) - l) / (1.0 + 1.0 / w);
        w -= step;
        if (!(fabs(step) > 1e-16 * w)) break;
    }
    return w;
}

static inline double classifier_rosin_rammler(double x, double x63, double n) {
    if (!(x >= 0.0 && classifier__positive(x63) && classifier__positive(n))) return classifier__nan();
    return -riddle_expm1(-riddle_pow(x / x63, n));
}
static inline double classifier_rosin_rammler_size(double t, double x63, double n) {
    if (!(t >= 0.0 && t < 1.0 && classifier__positive(x63) && classifier__positive(n))) return classifier__nan();
    return x63 * riddle_pow(-riddle_log1p(-t), 1.0 / n);
}
static inline double classifier_plitt(double x, double x50, double m) {
    if (!(x >= 0.0 && classifier__positive(x50) && classifier__positive(m))) return classifier__nan();
    return -riddle_expm1(-0.6931471805599453 * riddle_pow(x / x50, m));
}
static inline double classifier_plitt_size(double t, double x50, double m) {
    if (!(t >= 0.0 && t < 1.0 && classifier__positive(x50) && classifier__positive(m))) return classifier__nan();
    return x50 * riddle_pow(-riddle_log1p(-t) / 0.6931471805599453, 1.0 / m);
}
static inline double classifier_molerus_hoffmann(double x, double x50, double alpha) {
    if (!(x >= 0.0 && classifier__positive(x50) && alpha >= 0.0 && alpha < HUGE_VAL)) return classifier__nan();
    double z = x / x50 * (x / x50);
    if (!(z < 1e300)) return 1.0;
    return z > 0.0 ? 1.0 / (1.0 + riddle_exp(alpha * (1.0 - z)) / z) : 0.0;
}
static inline double classifier_molerus_hoffmann_size(double t, double x50, double alpha) {
    if (!(t >= 0.0 && t < 1.0 && classifier__positive(x50) && alpha >= 0.0 && alpha < HUGE_VAL))
        return classifier__nan();
    if (t == 0.0) return 0.0;
    double odds = t / (1.0 - t);
    if (alpha * (1.0 + odds) < 1e-16) return x50 * sqrt(odds);
    return x50 * sqrt(classifier__lambert_w_exp(riddle_log(alpha) + alpha + riddle_log(odds)) / alpha);
}

static inline classifier_curve classifier_curve_of(classifier_curve_law law, double size, double slope) {
    classifier_curve c;
    c.law = law;
    c.size = size;
    c.slope = slope;
    c.bypass = 0.0;
    c.hook_size = HUGE_VAL;
    return c;
}

static inline double classifier__curve_clean(const classifier_curve *c, double x) {
    if (c->law == CLASSIFIER_PLITT) return classifier_plitt(x, c->size, c->slope);
    if (c->law == CLASSIFIER_ROSIN_RAMMLER) return classifier_rosin_rammler(x, c->size, c->slope);
    return classifier_molerus_hoffmann(x, c->size, c->slope);
}

static inline double classifier_curve_value(const classifier_curve *c, double x) {
    if (!(c->bypass >= 0.0 && c->bypass < 1.0 && c->hook_size > 0.0)) return classifier__nan();
    double b = x < c->hook_size ? c->bypass * (1.0 - x / c->hook_size) : 0.0;
    return b + (1.0 - b) * classifier__curve_clean(c, x);
}

/* >>wheel ========================================================================================================== */

static inline double classifier_radial_velocity(const classifier_wheel *wheel, double air_flow, double r) {
    double open = 2.0 * RIDDLE_PI * r - wheel->paddles * wheel->thickness;
    return open > 0.0 && classifier__positive(wheel->height) ? air_flow / (wheel->height * open) : classifier__nan();
}

static inline classifier_distribution classifier_normal(double mean, double sd, double low, double high) {
    classifier_distribution d;
    d.shape = CLASSIFIER_NORMAL;
    d.mean = mean;
    d.sd = sd;
    d.low = low;
    d.high = high;
    d.bins = 0;
    d.edge[0] = d.cumulative[0] = 0.0;
    return d;
}

#ifdef CLASSIFIER__BODIES

/* >>distributions ================================================================================================== */

static inline double classifier__polynomial(double z, const double *c, int n) { /* c[0] z^n + ... + c[n] */
    double p = c[0];
    for (int i = 1; i <= n; i++) p = p * z + c[i];
    return p;
}

/* Returns P(N > z) for a normal N by the rational approximations of erfc of Cody 1969. */
static inline double classifier__normal_above(double z) {
    const double a[] = {1.85777706184603153e-1, 3.16112374387056560, 1.13864154151050156e2, 3.77485237685302021e2,
                        3.20937758913846947e3};
    const double b[] = {1.0, 2.36012909523441209e1, 2.44024637934444173e2, 1.28261652607737228e3,
                        2.84423683343917062e3};
    const double c[] = {2.15311535474403846e-8, 5.64188496988670089e-1, 8.88314979438837594,
                        6.61191906371416295e1,  2.98635138197400131e2,  8.81952221241769090e2,
                        1.71204761263407058e3,  2.05107837782607147e3,  1.23033935479799725e3};
    const double d[] = {1.0,
                        1.57449261107098347e1,
                        1.17693950891312499e2,
                        5.37181101862009858e2,
                        1.62138957456669019e3,
                        3.29079923573345963e3,
                        4.36261909014324716e3,
                        3.43936767414372164e3,
                        1.23033935480374942e3};
    const double p[] = {1.63153871373020978e-2, 3.05326634961232344e-1, 3.60344899949804439e-1,
                        1.25781726111229246e-1, 1.60837851487422766e-2, 6.58749161529837803e-4};
    const double q[] = {1.0,
                        2.56852019228982242,
                        1.87295284992346725,
                        5.27905102951428412e-1,
                        6.05183413124413191e-2,
                        2.33520497626869185e-3};
    double y = fabs(z) * 0.70710678118654752, value;
    if (z != z) return z;
    if (y > 26.6) return z > 0.0 ? 0.0 : 1.0;
    if (y <= 0.46875)
        return 0.5 -
               0.5 * (z < 0.0 ? -y : y) * classifier__polynomial(y * y, a, 4) / classifier__polynomial(y * y, b, 4);
    if (y <= 4.0) {
        value = classifier__polynomial(y, c, 8) / classifier__polynomial(y, d, 8);
    } else {
        double s = 1.0 / (y * y);
        value = (0.56418958354775629 - s * classifier__polynomial(s, p, 5) / classifier__polynomial(s, q, 5)) / y;
    }
    value *= 0.5 * riddle_exp(-0.5 * z * z);
    return z > 0.0 ? value : 1.0 - value;
}

/* Returns P(a < N < b), computed from the nearer tail. */
static inline double classifier__normal_between(double a, double b) {
    return b < 0.0 ? classifier__normal_above(-b) - classifier__normal_above(-a)
                   : classifier__normal_above(a) - classifier__normal_above(b);
}

/* Returns z with P(N < z) = u, 0 < u < 1, to 1e-16: Wichura 1988, algorithm AS 241. */
static inline double classifier__normal_at(double u) {
    const double a[] = {2.5090809287301226727e3, 3.3430575583588128105e4, 6.7265770927008700853e4,
                        4.5921953931549871457e4, 1.3731693765509461125e4, 1.9715909503065514427e3,
                        1.3314166789178437745e2, 3.3871328727963666080};
    const double b[] = {
        5.2264952788528545610e3, 2.8729085735721942674e4, 3.9307895800092710610e4, 2.1213794301586595867e4,
        5.3941960214247511077e3, 6.8718700749205790830e2, 4.2313330701600911252e1, 1.0};
    const double c[] = {7.74545014278341407640e-4, 2.27238449892691845833e-2, 2.41780725177450611770e-1,
                        1.27045825245236838258,    3.64784832476320460504,    5.76949722146069140550,
                        4.63033784615654529590,    1.42343711074968357734};
    const double d[] = {
        1.05075007164441684324e-9, 5.47593808499534494600e-4, 1.51986665636164571966e-2, 1.48103976427480074590e-1,
        6.89767334985100004550e-1, 1.67638483018380384940,    2.05319162663775882187,    1.0};
    const double e[] = {2.01033439929228813265e-7, 2.71155556874348757815e-5, 1.24266094738807843860e-3,
                        2.65321895265761230930e-2, 2.96560571828504891230e-1, 1.78482653991729133580,
                        5.46378491116411436990,    6.65790464350110377720};
    const double f[] = {
        2.04426310338993978564e-15, 1.42151175831644588870e-7, 1.84631831751005468180e-5, 7.86869131145613259100e-4,
        1.48753612908506148525e-2,  1.36929880922735805310e-1, 5.99832206555887937690e-1, 1.0};
    double q = u - 0.5;
    if (fabs(q) <= 0.425) {
        double r = 0.180625 - q * q;
        return q * classifier__polynomial(r, a, 7) / classifier__polynomial(r, b, 7);
    }
    double r = sqrt(-riddle_log(q < 0.0 ? u : 1.0 - u)), z;
    if (r <= 5.0) z = classifier__polynomial(r - 1.6, c, 7) / classifier__polynomial(r - 1.6, d, 7);
    else z = classifier__polynomial(r - 5.0, e, 7) / classifier__polynomial(r - 5.0, f, 7);
    return q < 0.0 ? -z : z;
}

CLASSIFIER_API classifier_status classifier_histogram(const double *edge, const double *shares, int bins,
                                                      classifier_distribution *made) {
    if (!made || (bins > 0 && (!edge || !shares)) || bins > CLASSIFIER_BINS) return CLASSIFIER_BAD_ARGUMENT;
    if (bins <= 0) return CLASSIFIER_EMPTY;
    double total = 0.0;
    for (int i = 0; i < bins; i++) {
        if (!(shares[i] >= 0.0 && shares[i] < HUGE_VAL && fabs(edge[i]) < HUGE_VAL && fabs(edge[i + 1]) < HUGE_VAL))
            return CLASSIFIER_BAD_ARGUMENT;
        if (!(edge[i + 1] > edge[i])) return CLASSIFIER_NOT_SORTED;
        total += shares[i];
    }
    if (!(total > 0.0)) return CLASSIFIER_EMPTY;
    if (!(fabs(total - 1.0) <= 1e-3)) return CLASSIFIER_NOT_NORMALISED;
    classifier_distribution d = classifier_normal(0.0, 0.0, edge[0], edge[bins]);
    d.shape = CLASSIFIER_HISTOGRAM;
    d.bins = bins;
    double sum = 0.0;
    d.edge[0] = edge[0];
    for (int i = 0; i < bins; i++) {
        sum += shares[i];
        d.edge[i + 1] = edge[i + 1];
        d.cumulative[i + 1] = i + 1 < bins ? sum / total : 1.0;
    }
    *made = d;
    made->mean = classifier_distribution_mean(&d);
    return CLASSIFIER_OK;
}

CLASSIFIER_API classifier_status classifier_check_distribution(const classifier_distribution *d) {
    if (!d) return CLASSIFIER_BAD_ARGUMENT;
    if (d->shape == CLASSIFIER_HISTOGRAM) {
        if (d->bins < 1) return CLASSIFIER_EMPTY;
        if (d->bins > CLASSIFIER_BINS) return CLASSIFIER_BAD_ARGUMENT;
        for (int i = 0; i < d->bins; i++) {
            if (!(d->edge[i + 1] > d->edge[i])) return CLASSIFIER_NOT_SORTED;
            if (!(d->cumulative[i + 1] >= d->cumulative[i])) return CLASSIFIER_BAD_ARGUMENT;
        }
        return d->cumulative[0] == 0.0 && d->cumulative[d->bins] == 1.0 && fabs(d->edge[0]) < HUGE_VAL &&
                       fabs(d->edge[d->bins]) < HUGE_VAL
                   ? CLASSIFIER_OK
                   : CLASSIFIER_NOT_NORMALISED;
    }
    if (d->shape != CLASSIFIER_NORMAL ||
        !(fabs(d->mean) < HUGE_VAL && d->sd >= 0.0 && d->sd < HUGE_VAL && d->low <= d->high))
        return CLASSIFIER_BAD_ARGUMENT;
    if (d->sd == 0.0) return d->mean >= d->low && d->mean <= d->high ? CLASSIFIER_OK : CLASSIFIER_EMPTY;
    double mass = classifier__normal_between((d->low - d->mean) / d->sd, (d->high - d->mean) / d->sd);
    return mass > 1e-9 ? CLASSIFIER_OK : CLASSIFIER_EMPTY;
}

/* Returns P(X < value). normal_low, normal_mass: P(N > low) and P(low < N < high); if high is below the mean,
   normal_low is -P(N < low) <= 0, which keeps its digits. */
static inline double classifier__below(const classifier_distribution *d, double value, double normal_low,
                                       double normal_mass) {
    if (!(value > d->low)) return value != value ? value : 0.0;
    if (!(value < d->high)) return 1.0;
    if (d->shape == CLASSIFIER_HISTOGRAM) {
        int low = 0, high = d->bins;
        while (high - low > 1) {
            int middle = (low + high) / 2;
            if (value >= d->edge[middle]) low = middle;
            else high = middle;
        }
        return d->cumulative[low] +
               (d->cumulative[high] - d->cumulative[low]) * (value - d->edge[low]) / (d->edge[high] - d->edge[low]);
    }
    if (d->sd == 0.0) return value > d->mean ? 1.0 : 0.0;
    if (normal_low <= 0.0) return (classifier__normal_above((d->mean - value) / d->sd) + normal_low) / normal_mass;
    return (normal_low - classifier__normal_above((value - d->mean) / d->sd)) / normal_mass;
}

static inline double classifier__at(const classifier_distribution *d, double u, double normal_low, double normal_mass) {
    if (d->shape == CLASSIFIER_HISTOGRAM) {
        int low = 0, high = d->bins;
        while (high - low > 1) {
            int middle = (low + high) / 2;
            if (u >= d->cumulative[middle]) low = middle;
            else high = middle;
        }
        double width = d->cumulative[high] - d->cumulative[low];
        return d->edge[low] + (width > 0.0 ? (u - d->cumulative[low]) / width : 0.0) * (d->edge[high] - d->edge[low]);
    }
    if (d->sd == 0.0) return d->mean;
    /* from the nearer tail: 1 - u would lose digits */
    double tail = classifier__normal_at(fabs(normal_low - u * normal_mass)),
           x = d->mean + (normal_low > 0.0 ? -d->sd : d->sd) * tail;
    return x < d->low ? d->low : x > d->high ? d->high : x;
}

/* A distribution with the constants of its normal law, as classifier__below wants them */
typedef struct classifier__drawer {
    const classifier_distribution *d;
    double low, mass;
} classifier__drawer;
static inline classifier__drawer classifier__drawer_of(const classifier_distribution *d) {
    classifier__drawer w;
    w.d = d;
    w.low = w.mass = 1.0;
    if (d->shape == CLASSIFIER_NORMAL && d->sd > 0.0) {
        double a = (d->low - d->mean) / d->sd, b = (d->high - d->mean) / d->sd;
        w.low = b < 0.0 ? -classifier__normal_above(-a) : classifier__normal_above(a);
        w.mass = classifier__normal_between(a, b);
    }
    return w;
}
static inline double classifier__draw(const classifier__drawer *w, double u) {
    return classifier__at(w->d, u, w->low, w->mass);
}
static inline double classifier__above(const classifier_distribution *d, double value) {
    classifier__drawer w = classifier__drawer_of(d);
    return 1.0 - classifier__below(d, value, w.low, w.mass);
}
CLASSIFIER_API double classifier_distribution_above(const classifier_distribution *d, double value) {
    return classifier_check_distribution(d) == CLASSIFIER_OK ? classifier__above(d, value) : classifier__nan();
}

CLASSIFIER_API double classifier_distribution_at(const classifier_distribution *d, double u) {
    if (!(u > 0.0 && u < 1.0) || classifier_check_distribution(d) != CLASSIFIER_OK) return classifier__nan();
    classifier__drawer w = classifier__drawer_of(d);
    return classifier__draw(&w, u);
}

CLASSIFIER_API double classifier_distribution_mean(const classifier_distribution *d) {
    if (classifier_check_distribution(d) != CLASSIFIER_OK) return classifier__nan();
    if (d->shape == CLASSIFIER_HISTOGRAM) {
        double sum = 0.0;
        for (int i = 0; i < d->bins; i++)
            sum += (d->cumulative[i + 1] - d->cumulative[i]) * 0.5 * (d->edge[i] + d->edge[i + 1]);
        return sum;
    }
    if (d->sd == 0.0) return d->mean;
    double a = (d->low - d->mean) / d->sd, b = (d->high - d->mean) / d->sd;
    double mass = classifier__normal_between(a, b);
    double density = (a > -HUGE_VAL ? riddle_exp(-0.5 * a * a) : 0.0) - (b < HUGE_VAL ? riddle_exp(-0.5 * b * b) : 0.0);
    return d->mean + d->sd * 0.39894228040143268 * density / mass;
}

CLASSIFIER_API classifier_status classifier_contact_weights(const classifier_contacts *c, classifier_weights *weights) {
    if (weights) *weights = classifier__weights_nan();
    if (!c || !weights) return CLASSIFIER_BAD_ARGUMENT;
    if (c->law == CLASSIFIER_COUNTED) {
        if (c->counts > CLASSIFIER_BINS) return CLASSIFIER_BAD_ARGUMENT;
        double total = 0.0;
        classifier_weights sum = classifier__weights(0.0, 0.0, 0.0);
        for (int n = 0; n < c->counts; n++) {
            if (!(c->share[n] >= 0.0 && c->share[n] < HUGE_VAL)) return CLASSIFIER_BAD_ARGUMENT;
            classifier_weights w = classifier_weights_of(n);
            total += c->share[n];
            sum.clean += c->share[n] * w.clean;
            sum.thrown += c->share[n] * w.thrown;
            sum.again += c->share[n] * w.again;
        }
        if (!(total > 0.0)) return CLASSIFIER_EMPTY;
        if (!(fabs(total - 1.0) <= 1e-3)) return CLASSIFIER_NOT_NORMALISED;
        *weights = classifier__weights(sum.clean / total, sum.thrown / total, sum.again / total);
        return CLASSIFIER_OK;
    }
    if (!(c->mean >= 0.0 && c->mean <= 1e6)) return CLASSIFIER_BAD_ARGUMENT;
    bool whole = c->mean == floor(c->mean);
    classifier_weights w = c->law == CLASSIFIER_POISSON     ? classifier_weights_poisson(c->mean)
                           : c->law == CLASSIFIER_GEOMETRIC ? classifier_weights_geometric(c->mean)
                           : c->law == CLASSIFIER_MARKOV && whole
                               ? classifier_weights_markov((int)c->mean, c->counter, c->wall)
                           : c->law == CLASSIFIER_FIXED && whole ? classifier_weights_of((int)c->mean)
                                                                 : classifier__weights_nan();
    if (!(w.clean >= 0.0)) return CLASSIFIER_BAD_ARGUMENT;
    *weights = w;
    return CLASSIFIER_OK;
}

/* >>root =========================================================================================================== */

/* Returns a zero of f in [a, b], where f(a) and f(b) have opposite signs, to 1e-14 of b, or an exact zero
   (Brent 1973). */
static inline double classifier__brent(double (*f)(double, const void *), const void *user, double a, double fa,
                                       double b, double fb) {
    double c = a, fc = fa, d = b - a, e = d;
    for (int i = 0; i < 200; i++) {
        if ((fb > 0.0) == (fc > 0.0)) {
            c = a;
            fc = fa;
            d = e = b - a;
        }
        if (fabs(fc) < fabs(fb)) {
            a = b;
            b = c;
            c = a;
            fa = fb;
            fb = fc;
            fc = fa;
        }
        double tolerance = 4e-16 * fabs(b) + 1e-15, half = 0.5 * (c - b);
        if (fabs(half) <= tolerance || fb == 0.0) break;
        if (fabs(e) >= tolerance && fabs(fa) > fabs(fb)) {
            double s = fb / fa, p, q;
            if (a == c) {
                p = 2.0 * half * s;
                q = 1.0 - s;
            } else {
                double u = fa / fc, v = fb / fc;
                p = s * (2.0 * half * u * (u - v) - (b - a) * (v - 1.0));
                q = (u - 1.0) * (v - 1.0) * (s - 1.0);
            }
            if (p > 0.0) q = -q;
            else p = -p;
            double bound = 3.0 * half * q - fabs(tolerance * q);
            if (fabs(e * q) < bound) bound = fabs(e * q);
            if (2.0 * p < bound) {
                e = d;
                d = p / q;
            } else {
                d = e = half;
            }
        } else {
            d = e = half;
        }
        a = b;
        fa = fb;
        b += fabs(d) > tolerance ? d : half > 0.0 ? tolerance : -tolerance;
        fb = f(b, user);
        if (fb != fb) return classifier__nan();
    }
    return b;
}

/* Returns the exponential of a zero of a function of ln x between low and high; NaN if there is none. Goes from start
   in steps of `stride` until the sign changes, then uses Brent's method. */
static inline double classifier__find(double (*f)(double, const void *), const void *user, double low, double high,
                                      double start, double stride) {
    low = riddle_log(low);
    high = riddle_log(high);
    double a = start > 0.0 ? riddle_log(start) : 0.5 * (low + high);
    if (!(a > low)) a = low;
    if (!(a < high)) a = high;
    double fa = f(a, user), way = fa < 0.0 ? stride : -stride; /* f rises */
    while (fa != 0.0) {
        double b = a + way;
        if (b < low) b = low;
        if (b > high) b = high;
        if (b == a || fa != fa) return classifier__nan();
        double fb = f(b, user);
        if (fb != fb) return classifier__nan();
        if ((fb < 0.0) != (fa < 0.0)) return riddle_exp(classifier__brent(f, user, a, fa, b, fb));
        a = b;
        fa = fb;
        way *= 1.5;
    }
    return riddle_exp(a);
}

/* >>sampling ======================================================================================================= */

enum { CLASSIFIER__REBOUNDS = 4, CLASSIFIER__NUMBERS = 11 + CLASSIFIER__REBOUNDS, CLASSIFIER__CELLS = 512 };
/* What each random number is for, the most important first. The last one is only needed without preintegration. */
enum {
    CLASSIFIER__U_REBOUND,
    CLASSIFIER__U_SHAPE,
    CLASSIFIER__U_ENTRY,
    CLASSIFIER__U_TANGENTIAL,
    CLASSIFIER__U_RADIAL,
    CLASSIFIER__U_RESTITUTION,
    CLASSIFIER__U_REBOUND_2,
    CLASSIFIER__U_CONE,
    CLASSIFIER__U_PARTNER,
    CLASSIFIER__U_ENTRY_2,
    CLASSIFIER__U_TANGENTIAL_2,
    CLASSIFIER__U_RADIAL_2,
    CLASSIFIER__U_RESTITUTION_2,
    CLASSIFIER__DIMENSIONS
};

static inline uint64_t classifier__mix(uint64_t *state) { /* splitmix64, Steele et al. 2014 */
    uint64_t z = (*state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}
static inline double classifier__uniform(uint64_t bits) {
    return ((double)(bits >> 11) + 0.5) * (1.0 / 9007199254740992.0);
} /* inside (0, 1) */

/* One point sequence in the unit cube. */
typedef struct classifier__sequence {
    classifier_sampler sampler;
    int points;
    uint64_t random;                            /* state of splitmix64 */
    uint32_t generator[CLASSIFIER__DIMENSIONS]; /* lattice: powers of one multiplier (Korobov) */
    double shift[CLASSIFIER__DIMENSIONS];
    uint32_t digits[CLASSIFIER__DIMENSIONS]; /* Sobol: random digital shift */
    uint32_t sobol[CLASSIFIER__DIMENSIONS];  /* current point */
    uint32_t direction[CLASSIFIER__DIMENSIONS][32];
} classifier__sequence;

static inline void classifier__sequence_begin(classifier__sequence *s, classifier_sampler sampler, int points,
                                              uint64_t seed, int repetition) {
    s->sampler = sampler;
    s->points = points;
    s->random = seed;
    s->random = classifier__mix(&s->random) + (uint64_t)repetition;
    s->random = classifier__mix(&s->random);
    for (int j = 0; j < CLASSIFIER__DIMENSIONS; j++) {
        s->shift[j] = classifier__uniform(classifier__mix(&s->random));
        s->digits[j] = (uint32_t)(classifier__mix(&s->random) >> 32);
        s->sobol[j] = 0;
    }
    /* the multiplier is the best of 400 for this model at 512, 1024 and 4096 points */
    for (int j = 0; j < CLASSIFIER__DIMENSIONS; j++)
        s->generator[j] = j ? s->generator[j - 1] * 117897u & 0xFFFFFu : 1u;
    if (sampler != CLASSIFIER_SOBOL) return;
    /* Joe & Kuo 2008: degree, coefficients of the primitive polynomial, first direction numbers */
    const unsigned char table[CLASSIFIER__DIMENSIONS - 1][7] = {{1, 0, 1},
                                                                {2, 1, 1, 3},
                                                                {3, 1, 1, 3, 1},
                                                                {3, 2, 1, 1, 1},
                                                                {4, 1, 1, 1, 3, 3},
                                                                {4, 4, 1, 3, 5, 13},
                                                                {5, 2, 1, 1, 5, 5, 17},
                                                                {5, 4, 1, 1, 5, 5, 5},
                                                                {5, 7, 1, 1, 7, 11, 19},
                                                                {5, 11, 1, 1, 5, 1, 1},
                                                                {5, 13, 1, 1, 1, 3, 11},
                                                                {5, 14, 1, 3, 5, 5, 31}};
    for (int k = 0; k < 32; k++) s->direction[0][k] = (uint32_t)1 << (31 - k);
    for (int j = 1; j < CLASSIFIER__DIMENSIONS; j++) {
        int degree = table[j - 1][0];
        uint32_t *v = s->direction[j];
        for (int k = 0; k < 32; k++) {
            if (k < degree) {
                v[k] = (uint32_t)table[j - 1][2 + k] << (31 - k);
                continue;
            }
            v[k] = v[k - degree] ^ (v[k - degree] >> degree);
            for (int l = 1; l < degree; l++)
                if (table[j - 1][1] >> (degree - 1 - l) & 1) v[k] ^= v[k - l];
        }
    }
}

/* Computes point i of the sequence into u[DIMENSIONS], inside (0, 1). Points must be computed in order. */
static inline void classifier__sequence_point(classifier__sequence *s, int i, double *u) {
    const double per_point = 1.0 / s->points;
    int bit = 0;
    while (s->sampler == CLASSIFIER_SOBOL && i > 0 && !(i >> bit & 1)) bit++;
    for (int j = 0; j < CLASSIFIER__DIMENSIONS; j++) {
        if (s->sampler == CLASSIFIER_MONTE_CARLO) {
            u[j] = classifier__uniform(classifier__mix(&s->random));
        } else if (s->sampler == CLASSIFIER_SOBOL) { /* Gray code order: one change a point */
            if (i > 0) s->sobol[j] ^= s->direction[j][bit];
            u[j] = ((double)(s->sobol[j] ^ s->digits[j]) + 0.5) * (1.0 / 4294967296.0);
        } else {
            double at = (double)((uint32_t)i * s->generator[j] & (uint32_t)(s->points - 1)) * per_point + s->shift[j];
            if (at >= 1.0) at -= 1.0;
            /* the tent map makes the integrand periodic; in an angle it is so already, being even */
            if (j != CLASSIFIER__U_REBOUND && j != CLASSIFIER__U_REBOUND_2 && j != CLASSIFIER__U_CONE)
                at = fabs(2.0 * at - 1.0);
            u[j] = at < 1e-15 ? 1e-15 : at > 1.0 - 1e-15 ? 1.0 - 1e-15 : at;
        }
    }
}

/* >>model ========================================================================================================== */

#define CLASSIFIER__COOKIE 0xC1A551F1u

CLASSIFIER_API classifier_def classifier_paper_def(classifier_material material, double rpm, unsigned *flags) {
    double degree = RIDDLE_PI / 180.0, speed = rpm < 3000.0 ? 3000.0 : rpm > 15000.0 ? 15000.0 : rpm;
    double to_9000 = speed < 9000.0 ? (speed - 3000.0) / 6000.0 : 1.0,
           to_15000 = speed > 9000.0 ? (speed - 9000.0) / 6000.0 : 0.0;
    bool beads = material == CLASSIFIER_BEADS, ground = material == CLASSIFIER_GROUND_GLASS;
    double radial = riddle_pow(speed / 3000.0, 0.9372);
    classifier_def d;
    d.cookie = CLASSIFIER__COOKIE;
    d.wheel.outer_radius = 0.025;
    d.wheel.inner_radius = 0.018;
    d.wheel.paddles = 24;
    d.wheel.thickness = 0.002;
    d.rpm = rpm;
    d.air_flow = 75.0 / 3600.0;
    d.wheel.height = d.air_flow / (7.1 * (2.0 * RIDDLE_PI * 0.025 - 0.048)); /* the paper's 7.1 m/s at the rim */
    d.fluid_density = 1.2;
    d.viscosity = 1.81e-5;
    d.particle_density = material == CLASSIFIER_LIMESTONE ? 2700.0 : 2500.0;
    d.radial_factor = 2.7 + 1.4 * to_9000 + 0.2 * to_15000;
    d.tangential_velocity = classifier_normal(1.5 * (1.0 - to_9000), 1.0, -HUGE_VAL, HUGE_VAL);
    d.radial_velocity = classifier_normal(radial, 0.5 * radial, 0.0, HUGE_VAL);
    d.restitution = classifier_normal(beads ? 0.75 : 0.29, beads ? 0.12 : 0.15, 0.0, 1.0);
    d.imperfection = classifier_normal(0.0, degree * (beads ? 22.0 : ground ? 42.0 : 37.0), -RIDDLE_PI, RIDDLE_PI);
    d.sphericity_2d = classifier_normal(beads ? 0.98 : ground ? 0.80 : 0.83, beads ? 0.005 : 0.04, 0.0, 1.0);
    d.sphericity_is_3d = false;
    d.contacts.law = CLASSIFIER_GEOMETRIC;
    d.contacts.mean = beads ? 0.2 : 1.0;
    d.contacts.counts = 0;
    for (int i = 0; i < CLASSIFIER_BINS; i++) d.contacts.share[i] = 0.0;
    d.contacts.counter = d.contacts.wall = 0.5;
    d.particle_restitution = beads ? 0.75 : 0.29;
    d.cone_half_angle = 65.0 * degree;
    d.impulse_along_centres = false;
    d.law = CLASSIFIER_HOELZER_SOMMERFELD;
    d.basis = CLASSIFIER_EQUIVALENT;
    d.buoyancy = false;
    d.size_low = 1e-7;
    d.size_high = 1e-2;
    d.sampler = CLASSIFIER_LATTICE;
    d.preintegrate = true;
    d.points = 1024;
    d.shifts = 8;
    d.seed = 1;
    d.approach_size = 0.0;
    if (flags) *flags = rpm == speed ? 0u : (unsigned)CLASSIFIER_EXTRAPOLATED;
    return d;
}

CLASSIFIER_API classifier_def classifier_default_def(void) {
    return classifier_paper_def(CLASSIFIER_LIMESTONE, 3000.0, NULL);
}

CLASSIFIER_API classifier_status classifier_check_def(const classifier_def *def, const char **field) {
    const char *dummy;
    classifier_status status;
    if (!field) field = &dummy;
    *field = "def";
    if (!def) return CLASSIFIER_BAD_ARGUMENT;
#define CLASSIFIER__NEED(name, condition)                                                                              \
    *field = name;                                                                                                     \
    if (!(condition)) return CLASSIFIER_BAD_DEFINITION;
    CLASSIFIER__NEED("cookie", def->cookie == CLASSIFIER__COOKIE)
    CLASSIFIER__NEED("wheel.inner_radius", classifier__positive(def->wheel.inner_radius))
    CLASSIFIER__NEED("wheel.outer_radius",
                     def->wheel.outer_radius > def->wheel.inner_radius && def->wheel.outer_radius < HUGE_VAL)
    CLASSIFIER__NEED("wheel.height", classifier__positive(def->wheel.height))
    CLASSIFIER__NEED("wheel.paddles", def->wheel.paddles >= 1)
    CLASSIFIER__NEED("wheel.thickness", def->wheel.thickness >= 0.0 && def->wheel.paddles * def->wheel.thickness <
                                                                           2.0 * RIDDLE_PI * def->wheel.inner_radius)
    CLASSIFIER__NEED("rpm", def->rpm > 0.0 && def->rpm <= 1e9)
    CLASSIFIER__NEED("air_flow", classifier__positive(def->air_flow))
    CLASSIFIER__NEED("fluid_density", classifier__positive(def->fluid_density))
    CLASSIFIER__NEED("viscosity", classifier__positive(def->viscosity))
    CLASSIFIER__NEED("particle_density", classifier__positive(def->particle_density) &&
                                             (!def->buoyancy || def->particle_density > def->fluid_density))
    CLASSIFIER__NEED("radial_factor", classifier__positive(def->radial_factor))
    CLASSIFIER__NEED("approach_size",
                     def->approach_size == 0.0 || (def->approach_size >= 1e-9 && def->approach_size <= 1.0))
    CLASSIFIER__NEED("particle_restitution", def->particle_restitution >= 0.0 && def->particle_restitution <= 1.0)
    CLASSIFIER__NEED("cone_half_angle", def->cone_half_angle >= 0.0 && def->cone_half_angle <= 0.5 * RIDDLE_PI)
    CLASSIFIER__NEED("law", def->law <= CLASSIFIER_STOKES)
    CLASSIFIER__NEED("basis", def->basis <= CLASSIFIER_PROJECTED)
    CLASSIFIER__NEED("size_low", classifier__positive(def->size_low))
    CLASSIFIER__NEED("size_high", def->size_high > def->size_low && def->size_high < HUGE_VAL)
    CLASSIFIER__NEED("sampler", def->sampler <= CLASSIFIER_MONTE_CARLO)
    CLASSIFIER__NEED("points", def->points >= 16 && def->points <= 1 << 20 && (def->points & (def->points - 1)) == 0)
    CLASSIFIER__NEED("shifts", def->shifts >= 2 && def->shifts <= CLASSIFIER_MAX_SHIFTS)
#undef CLASSIFIER__NEED
    const classifier_distribution *all[] = {&def->tangential_velocity, &def->radial_velocity, &def->restitution,
                                            &def->imperfection, &def->sphericity_2d};
    const char *const names[] = {"tangential_velocity", "radial_velocity", "restitution", "imperfection",
                                 "sphericity_2d"};
    const double low[] = {-HUGE_VAL, 0.0, 0.0, -HUGE_VAL, 0.0}, high[] = {HUGE_VAL, HUGE_VAL, 1.0, HUGE_VAL, 1.0};
    for (int i = 0; i < 5; i++) {
        *field = names[i];
        status = classifier_check_distribution(all[i]);
        if (status != CLASSIFIER_OK) return status;
        /* a speed beyond light would overflow */
        if (fabs(all[i]->mean) > 1e9 || all[i]->sd > 1e9) return CLASSIFIER_BAD_DEFINITION;
        if (all[i]->low < low[i] || all[i]->high > high[i]) return CLASSIFIER_BAD_DEFINITION;
    }
    *field = "imperfection"; /* rebounds into the paddle do not count: some must be left */
    if (!(classifier_distribution_above(all[3], -0.5) - classifier_distribution_above(all[3], 0.5) > 1e-6))
        return CLASSIFIER_BAD_DEFINITION;
    *field = "sphericity_2d";
    if (!(all[4]->high > 0.0)) return CLASSIFIER_BAD_DEFINITION;
    *field = "contacts";
    classifier_weights weights;
    status = classifier_contact_weights(&def->contacts, &weights);
    if (status == CLASSIFIER_OK) *field = NULL;
    return status;
}

/* Computes sine and cosine. The angle between two paddles is small and needs no reduction. */
static inline void classifier__sincos(double angle, double *s, double *c) {
    bool small = fabs(angle) < 0.25 * RIDDLE_PI;
    *s = small ? riddle__sin_quarter(angle, 0) : riddle_sin(angle);
    *c = small ? riddle__sin_quarter(angle, 1) : riddle_cos(angle);
}

/* Computes where and how a particle meets the face of the paddle; radius_only: without speed and angle. */
static inline classifier_impact classifier__approach(const classifier_wheel *wheel, double angular_speed, double ahead,
                                                     double tangential_against, double radial_inward,
                                                     bool radius_only) {
    classifier_impact hit = {false, 0.0, 0.0, 0.0, 0.0, 0};
    double ra = wheel->outer_radius, face = 0.5 * wheel->thickness, turn = 2.0 * RIDDLE_PI / angular_speed, s, c;
    classifier__sincos(ahead, &s, &c);
    double px = ra * c, py = ra * s, vx = tangential_against * s - radial_inward * c,
           vy = -tangential_against * c - radial_inward * s;
    double t = (ahead - face / ra) / (angular_speed + tangential_against / ra);
    if (!(t >= 0.0 && t < turn)) return hit;         /* it runs away from the face (or an argument is NaN) */
    for (hit.iterations = 0; hit.iterations < 30;) { /* face normal (-s, c) . position = thickness / 2 */
        classifier__sincos(angular_speed * t, &s, &c);
        double x = px + vx * t, y = py + vy * t, gap = c * y - s * x - face;
        if (hit.iterations > 0 && fabs(gap) < 1e-14 * ra) {
            double r = sqrt(x * x + y * y), wx = vx + angular_speed * y, wy = vy - angular_speed * x;
            double course = px * vx + py * vy, speed2 = vx * vx + vy * vy,
                   inner2 = wheel->inner_radius * wheel->inner_radius;
            if (r < wheel->inner_radius ||
                (course < 0.0 && course + speed2 * t > 0.0 && (ra * ra - inner2) * speed2 < course * course))
                return hit; /* it was inside before: at the hit or at the middle of its chord */
            hit.hit = true;
            /* outside with almost no inward velocity: in the model as a rule by hundredths of a millimetre */
            hit.radius = r < ra ? r : ra;
            hit.time = t;
            if (radius_only) return hit;
            hit.speed = sqrt(wx * wx + wy * wy);
            hit.angle = riddle_atan2(c * wx + s * wy, s * wx - c * wy);
            return hit;
        }
        double rate = c * vy - s * vx - angular_speed * (c * x + s * y);
        if (!(rate < 0.0)) return hit;
        t -= gap / rate;
        hit.iterations++;
        if (!(t > -turn && t < turn)) return hit;
    }
    return hit;
}

CLASSIFIER_API classifier_impact classifier_approach(const classifier_wheel *wheel, double angular_speed, double ahead,
                                                     double tangential_against, double radial_inward) {
    const classifier_impact none = {false, 0.0, 0.0, 0.0, 0.0, 0};
    if (!wheel) return none;
    return classifier__approach(wheel, angular_speed, ahead, tangential_against, radial_inward, false);
}

/* Computes d/dt of {x, y, v_x, v_y} in the frame of the wheel: drag on the slip, centrifugal and Coriolis
   acceleration. */
static inline void classifier__motion_in_wheel(const classifier_def *def, classifier_drag drag, double size,
                                               const double *y, double *rate) {
    double omega = def->rpm * RIDDLE_PI / 30.0, r = sqrt(y[0] * y[0] + y[1] * y[1]);
    double in = def->radial_factor * classifier_radial_velocity(&def->wheel, def->air_flow, r);
    double u = -in * y[0] / r - y[2], v = -in * y[1] / r - y[3],
           re = def->fluid_density * sqrt(u * u + v * v) * size / def->viscosity;
    double driving = def->buoyancy ? def->particle_density - def->fluid_density : def->particle_density;
    double scale = 0.75 * def->viscosity / (driving * size * size); /* times c_D Re */
    double per_slip = scale * (re > 0.0 ? classifier_drag_coefficient(drag, re) * re : drag.c1);
    rate[0] = y[2], rate[1] = y[3];
    rate[2] = per_slip * u + omega * omega * y[0] + 2.0 * omega * y[3];
    rate[3] = per_slip * v + omega * omega * y[1] - 2.0 * omega * y[2];
}

/* Makes a step of h by the classical Runge-Kutta method of order 4. */
static inline void classifier__step_in_wheel(const classifier_def *def, classifier_drag drag, double size, double h,
                                             double *y) {
    double k[4][4], at[4];
    classifier__motion_in_wheel(def, drag, size, y, k[0]);
    for (int s = 1; s < 4; s++) {
        for (int c = 0; c < 4; c++) at[c] = y[c] + h * (s < 3 ? 0.5 : 1.0) * k[s - 1][c];
        classifier__motion_in_wheel(def, drag, size, at, k[s]);
    }
    for (int c = 0; c < 4; c++) y[c] += h / 6.0 * (k[0][c] + 2.0 * k[1][c] + 2.0 * k[2][c] + k[3][c]);
}

enum { CLASSIFIER__FLIGHT_STEPS = 10000 };

/* Computes how a particle meets the face under the drag of the gas. The last step is shortened, by Newton's method, to
   end at the face. */
static inline classifier_impact classifier__approach_in_gas(const classifier_def *def, classifier_drag drag, double x,
                                                            double ahead, double tangential_against,
                                                            double radial_inward) {
    classifier_impact hit = {false, 0.0, 0.0, 0.0, 0.0, 0};
    double s, c;
    double omega = def->rpm * RIDDLE_PI / 30.0, ra = def->wheel.outer_radius, face = 0.5 * def->wheel.thickness,
           h = 0.01 / omega;
    double relaxation = def->particle_density * x * x / (18.0 * def->viscosity), turn = 2.0 * RIDDLE_PI / omega;
    classifier__sincos(ahead, &s, &c);
    double y[4] = {ra * c, ra * s, tangential_against * s - radial_inward * c + omega * ra * s,
                   -tangential_against * c - radial_inward * s - omega * ra * c};
    if (!(y[1] >= face)) return hit;
    h = h < 0.2 * relaxation ? h : 0.2 * relaxation;
    while (hit.time < turn && hit.iterations < CLASSIFIER__FLIGHT_STEPS) {
        double next[4] = {y[0], y[1], y[2], y[3]};
        classifier__step_in_wheel(def, drag, x, h, next);
        double r = sqrt(next[0] * next[0] + next[1] * next[1]);
        if (next[1] <= face) break;
        if (!(r >= def->wheel.inner_radius && r < 2.0 * ra)) return hit;
        for (int k = 0; k < 4; k++) y[k] = next[k];
        hit.time += h;
        hit.iterations++;
    }
    if (hit.iterations >= CLASSIFIER__FLIGHT_STEPS) return hit;
    double last = (face - y[1]) / y[3], end[4];
    for (int tries = 0; tries < 8; tries++) {
        for (int k = 0; k < 4; k++) end[k] = y[k];
        classifier__step_in_wheel(def, drag, x, last, end);
        last += (face - end[1]) / end[3];
    }
    double r = sqrt(end[0] * end[0] + end[1] * end[1]);
    if (!(last >= 0.0 && last <= 1.01 * h && r >= def->wheel.inner_radius && end[3] < 0.0)) return hit;
    hit.hit = true;
    hit.radius = r < ra ? r : ra;
    hit.time += last;
    hit.speed = sqrt(end[2] * end[2] + end[3] * end[3]);
    hit.angle = riddle_atan2(end[2], -end[3]);
    return hit;
}

CLASSIFIER_API classifier_impact classifier_approach_in_gas(const classifier_def *def, classifier_drag drag, double x,
                                                            double ahead, double tangential_against,
                                                            double radial_inward) {
    const classifier_impact none = {false, 0.0, 0.0, 0.0, 0.0, 0};
    if (!(classifier_check_def(def, NULL) == CLASSIFIER_OK && classifier__drag_ok(drag) && classifier__positive(x) &&
          x <= 1.0 && fabs(ahead) < 2.0 * RIDDLE_PI && fabs(tangential_against) < 1e9 && fabs(radial_inward) < 1e9))
        return none;
    return classifier__approach_in_gas(def, drag, x, ahead, tangential_against, radial_inward);
}

/* Returns the cosine of an angle within +-90 degrees. */
static inline double classifier__cos_forward(double angle) {
    double s = riddle__sin_quarter(0.5 * angle, 0);
    return 1.0 - 2.0 * s * s;
}

/* Computes the terms of the threshold velocity of one place and shape: v*^2 = k[0] / x^2 + k[1] / x^(1 + p) + k[2] /
   x. */
static inline void classifier__threshold_terms(const classifier_def *def, classifier_drag drag, double r, double *k) {
    double v = def->radial_factor * classifier_radial_velocity(&def->wheel, def->air_flow, r),
           a = def->fluid_density * v / def->viscosity;
    double scale = 0.75 * def->fluid_density /
                   (def->buoyancy ? def->particle_density - def->fluid_density : def->particle_density) * r * v * v;
    k[0] = scale * drag.c1 / a;
    k[1] = scale * drag.c2 / (drag.law == CLASSIFIER_SCHILLER_NAUMANN ? riddle_pow(a, 0.313) : sqrt(a));
    k[2] = scale * drag.c3;
}

static inline double classifier__sphericity_3d(const classifier_def *def, double drawn, bool *clamped) {
    if (!def->sphericity_is_3d) return classifier_rorato_clamped(drawn, clamped);
    return drawn > 1e-300 ? drawn : 1e-300;
}

static inline classifier_drag classifier__model_drag(const classifier_def *def, double psi) {
    if (def->law == CLASSIFIER_SCHILLER_NAUMANN) return classifier_schiller_naumann();
    if (def->law == CLASSIFIER_STOKES) return classifier_stokes();
    return classifier_hoelzer_sommerfeld(psi, def->basis);
}

/* Returns the inverse of a slope, limited: v_phi = start + slope e >= v* requires e >= (v* - start) / slope. */
static inline double classifier__inverse_slope(double slope) { return slope > 1e-290 ? 1.0 / slope : 1e290; }

/* What the random numbers come from, and one drawn particle. */
typedef struct classifier__recipe {
    const classifier_def *def;
    classifier__drawer tangential, radial, restitution, imperfection, sphericity;
    double omega, arc_low, arc;    /* entry angles */
    double straight_low, straight; /* shares of the imperfection below -90 degrees, and within +-90 */
    int rebounds;
} classifier__recipe;

static inline classifier__recipe classifier__recipe_of(const classifier_def *def) {
    classifier__recipe q;
    q.def = def;
    q.tangential = classifier__drawer_of(&def->tangential_velocity);
    q.radial = classifier__drawer_of(&def->radial_velocity);
    q.restitution = classifier__drawer_of(&def->restitution);
    q.imperfection = classifier__drawer_of(&def->imperfection);
    q.sphericity = classifier__drawer_of(&def->sphericity_2d);
    q.omega = def->rpm * RIDDLE_PI / 30.0;
    q.rebounds = def->preintegrate ? CLASSIFIER__REBOUNDS : 1;
    q.arc_low = riddle_asin(0.5 * def->wheel.thickness / def->wheel.outer_radius);
    q.arc = 2.0 * RIDDLE_PI / def->wheel.paddles - 2.0 * q.arc_low;
    q.straight_low = classifier__below(&def->imperfection, -0.5 * RIDDLE_PI, q.imperfection.low, q.imperfection.mass);
    q.straight = classifier__below(&def->imperfection, 0.5 * RIDDLE_PI, q.imperfection.low, q.imperfection.mass) -
                 q.straight_low;
    return q;
}

typedef struct classifier__particle {
    bool clamped;
    classifier_impact first, second;
    classifier_drag drag;
    double cos_first[CLASSIFIER__REBOUNDS], cos_second, share, v_t2, e_first, e_last;
} classifier__particle;

static inline classifier_impact classifier__draw_approach(const classifier__recipe *q, classifier_drag drag,
                                                          double entry, double tangential, double radial,
                                                          bool radius_only) {
    if (q->def->approach_size > 0.0)
        return classifier__approach_in_gas(q->def, drag, q->def->approach_size, q->arc_low + entry * q->arc,
                                           classifier__draw(&q->tangential, tangential),
                                           classifier__draw(&q->radial, radial));
    return classifier__approach(&q->def->wheel, q->omega, q->arc_low + entry * q->arc,
                                classifier__draw(&q->tangential, tangential), classifier__draw(&q->radial, radial),
                                radius_only);
}

static inline void classifier__draw_particle(const classifier__recipe *q, const double *u, classifier__particle *p) {
    const classifier_def *def = q->def;
    double quarter = 0.5 * RIDDLE_PI, psi = 1.0;
    p->clamped = false;
    if (def->law == CLASSIFIER_HOELZER_SOMMERFELD)
        psi = classifier__sphericity_3d(def, classifier__draw(&q->sphericity, u[CLASSIFIER__U_SHAPE]), &p->clamped);
    p->drag = classifier__model_drag(def, psi);
    p->first = classifier__draw_approach(q, p->drag, u[CLASSIFIER__U_ENTRY], u[CLASSIFIER__U_TANGENTIAL],
                                         u[CLASSIFIER__U_RADIAL], false);
    p->second = classifier__draw_approach(q, p->drag, u[CLASSIFIER__U_ENTRY_2], u[CLASSIFIER__U_TANGENTIAL_2],
                                          u[CLASSIFIER__U_RADIAL_2], true);
    double low =
        classifier__below(&def->imperfection, -quarter - p->first.angle, q->imperfection.low, q->imperfection.mass);
    double high =
        classifier__below(&def->imperfection, quarter - p->first.angle, q->imperfection.low, q->imperfection.mass);
    for (int k = 0; k < q->rebounds; k++) {
        double u_k = u[CLASSIFIER__U_REBOUND] + (double)k / (double)CLASSIFIER__REBOUNDS;
        if (u_k >= 1.0) u_k -= 1.0;
        p->cos_first[k] =
            classifier__cos_forward(p->first.angle + classifier__draw(&q->imperfection, low + u_k * (high - low)));
    }
    p->cos_second = classifier__cos_forward(
        classifier__draw(&q->imperfection, q->straight_low + u[CLASSIFIER__U_REBOUND_2] * q->straight));
    p->share = classifier__cos_forward(def->cone_half_angle * (2.0 * u[CLASSIFIER__U_CONE] - 1.0));
    if (def->impulse_along_centres) p->share *= p->share;
    p->v_t2 = classifier__draw(&q->tangential, u[CLASSIFIER__U_PARTNER]);
    p->e_first = classifier__draw(&q->restitution, u[CLASSIFIER__U_RESTITUTION]);
    p->e_last = def->preintegrate ? 0.0 : classifier__draw(&q->restitution, u[CLASSIFIER__U_RESTITUTION_2]);
}

/* Computes the lines v = start + slope e of the three cases (in case A after the first rebound); e is the first
   restitution in A and B, the second in C. */
static inline void classifier__case_lines(const classifier__recipe *q, const classifier__particle *p,
                                          double line[3][2]) {
    double w1 = q->omega * p->first.radius, w2 = q->omega * p->second.radius, gain = p->first.speed * p->cos_first[0],
           e_pp = q->def->particle_restitution;
    line[0][0] = w1;
    line[0][1] = gain;
    line[1][0] = classifier_rebound_thrown(w1, p->v_t2, e_pp, p->share);
    line[1][1] = 0.5 * (1.0 + e_pp) * p->share * gain;
    double v_a = classifier_rebound_paddle(w1, p->e_first, p->first.speed, p->cos_first[0]);
    double slowed = classifier_rebound_slowed(v_a, p->v_t2, e_pp, q->def->impulse_along_centres ? p->share : 1.0);
    bool caught = p->second.hit && slowed < w2; /* else the paddle does not catch up with it */
    line[2][0] = caught ? w2 : slowed;
    line[2][1] = caught ? (w2 - slowed) * p->cos_second : 0.0;
}

/* Stores the numbers of a particle in the model: threshold terms at the first hit [3] and at the second [3]; start of
   A's lines and their inverse slopes [REBOUNDS]; start and inverse slope for B and for C. Without preintegration the
   restitutions are drawn too, and every line is flat. */
static inline void classifier__store(const classifier__recipe *q, const classifier__particle *p, double *out) {
    const classifier_def *def = q->def;
    double line[3][2], *slopes = out + 7, *b = slopes + CLASSIFIER__REBOUNDS, *c = b + 2;
    if (!p->first.hit) { /* never rejected: a threshold that nothing reaches */
        for (int k = 0; k < CLASSIFIER__NUMBERS; k++) out[k] = k < 6 ? 1.0 : 1e290;
        out[6] = b[0] = c[0] = -1e290;
        return;
    }
    classifier__case_lines(q, p, line);
    classifier__threshold_terms(def, p->drag, p->first.radius, out);
    classifier__threshold_terms(def, p->drag, p->second.hit ? p->second.radius : p->first.radius, out + 3);
    if (!def->preintegrate) {
        for (int k = 0; k < 3; k++) {
            line[k][0] += line[k][1] * (k < 2 ? p->e_first : p->e_last);
            line[k][1] = 0.0;
        }
    }
    out[6] = line[0][0];
    for (int k = 0; k < CLASSIFIER__REBOUNDS; k++)
        slopes[k] = classifier__inverse_slope(def->preintegrate ? p->first.speed * p->cos_first[k] : 0.0);
    b[0] = line[1][0];
    b[1] = classifier__inverse_slope(line[1][1]);
    c[0] = line[2][0];
    c[1] = classifier__inverse_slope(line[2][1]);
}

/* Tabulates P(restitution >= e) on its effective support as quintics through value, slope and curvature:
   error 1e-13, 5 ns a call. */
static inline void classifier__survival_table(classifier_model *m) {
    const classifier_distribution *d = &m->def.restitution;
    classifier__drawer w = classifier__drawer_of(d);
    double low = d->mean - 8.5 * d->sd, high = d->mean + 8.5 * d->sd;
    if (low < d->low) low = d->low;
    if (high > d->high) high = d->high;
    double h = (high - low) / (double)CLASSIFIER__CELLS, f[2][3] = {{0.0}};
    m->table_low = low;
    m->table_scale = 1.0 / h;
    for (int i = 0; i <= CLASSIFIER__CELLS; i++) {
        double z = (low + i * h - d->mean) / d->sd,
               density = 0.39894228040143268 * riddle_exp(-0.5 * z * z) / (d->sd * w.mass) * h, *a = f[0], *b = f[1];
        for (int k = 0; k < 3; k++) a[k] = b[k];
        b[0] = 1.0 - classifier__below(d, low + i * h, w.low, w.mass);
        b[1] = -density;
        b[2] = z / d->sd * h * density * 0.5;
        if (i == 0) continue;
        double *c = m->table + 6 * (i - 1), p0 = b[0] - a[0] - a[1] - a[2], p1 = b[1] - a[1] - 2.0 * a[2],
               p2 = 2.0 * b[2] - 2.0 * a[2];
        c[0] = a[0];
        c[1] = a[1];
        c[2] = a[2];
        c[3] = 10.0 * p0 - 4.0 * p1 + 0.5 * p2;
        c[4] = -15.0 * p0 + 7.0 * p1 - p2;
        c[5] = 6.0 * p0 - 3.0 * p1 + 0.5 * p2;
    }
}

static inline void *classifier__grow(const classifier_memory *memory, void *old, size_t old_size, size_t new_size) {
    if (memory->fn) return memory->fn(memory->user, old, old_size, new_size);
    if (new_size) return realloc(old, new_size);
    free(old);
    return NULL;
}

static inline size_t classifier__model_size(const classifier_model *m) {
    return ((size_t)m->count * CLASSIFIER__NUMBERS + 6 * (size_t)CLASSIFIER__CELLS) * sizeof(double);
}

CLASSIFIER_API classifier_status classifier_init(classifier_model *model, const classifier_def *def,
                                                 const classifier_memory *memory) {
    if (!model) return CLASSIFIER_BAD_ARGUMENT;
    model->data = model->table = NULL;
    model->count = 0;
    classifier_status status = classifier_check_def(def, NULL);
    if (status != CLASSIFIER_OK) return status;
    model->def = *def;
    def = &model->def;
    model->memory.fn = memory ? memory->fn : NULL;
    model->memory.user = memory ? memory->user : NULL;
    model->count = def->points * def->shifts;
    model->table = (double *)classifier__grow(&model->memory, NULL, 0, classifier__model_size(model));
    if (!model->table) {
        model->count = 0;
        return CLASSIFIER_OUT_OF_MEMORY;
    }
    model->data = model->table + 6 * CLASSIFIER__CELLS;
    (void)classifier_contact_weights(&def->contacts, &model->weights); /* checked above */
    model->smooth = def->restitution.shape == CLASSIFIER_NORMAL && def->restitution.sd > 0.0;
    if (model->smooth) classifier__survival_table(model);

    classifier__recipe recipe = classifier__recipe_of(def);
    classifier__sequence sequence;
    double radius = 0.0, *out = model->data;
    int hits = 0, clamped = 0;
    for (int shift = 0; shift < def->shifts; shift++) {
        classifier__sequence_begin(&sequence, def->sampler, def->points, def->seed, shift);
        for (int i = 0; i < def->points; i++, out += CLASSIFIER__NUMBERS) {
            double u[CLASSIFIER__DIMENSIONS];
            classifier__particle p;
            classifier__sequence_point(&sequence, i, u);
            classifier__draw_particle(&recipe, u, &p);
            if (p.first.iterations >= CLASSIFIER__FLIGHT_STEPS) { /* that it does not hit is not known */
                classifier_free(model);
                return CLASSIFIER_OUTSIDE;
            }
            classifier__store(&recipe, &p, out);
            clamped += p.clamped;
            hits += p.first.hit;
            radius += p.first.radius;
        }
    }
    model->clamped = (double)clamped / model->count;
    model->missed = 1.0 - (double)hits / model->count;
    model->mean_radius = hits ? radius / hits : def->wheel.outer_radius;
    model->flags = (clamped ? (unsigned)CLASSIFIER_SPHERICITY_CLAMPED : 0u) |
                   (hits < model->count ? (unsigned)CLASSIFIER_MISSED : 0u);
    return CLASSIFIER_OK;
}

CLASSIFIER_API void classifier_free(classifier_model *model) {
    if (!model || !model->table) return;
    (void)classifier__grow(&model->memory, model->table, classifier__model_size(model), 0);
    model->data = model->table = NULL;
    model->count = 0;
}

static inline double classifier__survival(const classifier_model *m, double e) {
    if (!m->smooth) return classifier__above(&m->def.restitution, e);
    double at = (e - m->table_low) * m->table_scale;
    if (!(at > 0.0)) return 1.0;
    if (!(at < (double)CLASSIFIER__CELLS)) return 0.0;
    int i = (int)at;
    const double *c = m->table + 6 * i;
    double t = at - i;
    return c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))));
}

/* Means over each shift of the three cases, mean[shift][3]; the gas velocity may be `factor` times that of
   the definition. */
static inline void classifier__evaluate(const classifier_model *m, double x, double factor, double *mean) {
    int rebounds = m->def.preintegrate ? CLASSIFIER__REBOUNDS : 1;
    double p = m->def.law == CLASSIFIER_SCHILLER_NAUMANN ? 0.313 : 0.5;
    if (x < 1e-90) x = 1e-90; /* nothing is so fine; its powers would overflow */
    double f0 = factor / (x * x),
           f1 =
               p == 0.5 ? factor * sqrt(factor) / (x * sqrt(x)) : riddle_pow(factor, 2.0 - p) * riddle_pow(x, -1.0 - p),
           f2 = factor * factor / x;
    const double *q = m->data;
    for (int shift = 0; shift < m->def.shifts; shift++, mean += 3) {
        double clean = 0.0;
        mean[1] = mean[2] = 0.0;
        for (int i = 0; i < m->def.points; i++, q += CLASSIFIER__NUMBERS) {
            const double *b = q + 7 + CLASSIFIER__REBOUNDS;
            double v = sqrt(q[0] * f0 + q[1] * f1 + q[2] * f2), w = sqrt(q[3] * f0 + q[4] * f1 + q[5] * f2);
            for (int k = 0; k < rebounds; k++) clean += classifier__survival(m, (v - q[6]) * q[7 + k]);
            mean[1] += classifier__survival(m, (v - b[0]) * b[1]);
            mean[2] += classifier__survival(m, (w - b[2]) * b[3]);
        }
        mean[0] = clean / rebounds;
        for (int k = 0; k < 3; k++) mean[k] /= m->def.points;
    }
}

static inline double classifier__weighted(const classifier_model *m, double x, double factor, double *error) {
    double mean[3 * CLASSIFIER_MAX_SHIFTS], sum = 0.0, squares = 0.0;
    int n = m->def.shifts;
    classifier__evaluate(m, x, factor, mean);
    for (int i = 0; i < n; i++) {
        mean[i] =
            m->weights.clean * mean[3 * i] + m->weights.thrown * mean[3 * i + 1] + m->weights.again * mean[3 * i + 2];
        sum += mean[i];
    }
    sum /= n;
    for (int i = 0; i < n; i++) squares += (mean[i] - sum) * (mean[i] - sum);
    if (error) *error = riddle_student(0.95, n - 1) * sqrt(squares / ((n - 1.0) * n));
    return sum;
}

CLASSIFIER_API double classifier_tromp(const classifier_model *model, double x, double *error) {
    if (error) *error = classifier__nan();
    if (!(model && model->data && classifier__positive(x))) return classifier__nan();
    return classifier__weighted(model, x, 1.0, error);
}

CLASSIFIER_API void classifier_tromp_cases(const classifier_model *model, double x, double t[3]) {
    double mean[3 * CLASSIFIER_MAX_SHIFTS];
    bool fine = model && model->data && classifier__positive(x);
    if (!t) return;
    if (fine) classifier__evaluate(model, x, 1.0, mean);
    for (int k = 0; k < 3; k++) {
        t[k] = fine ? 0.0 : classifier__nan();
        for (int i = 0; fine && i < model->def.shifts; i++) t[k] += mean[3 * i + k] / model->def.shifts;
    }
}

typedef struct classifier__goal {
    const classifier_model *model;
    double t, x;
} classifier__goal;
static inline double classifier__quantile_gap(double ln_x, const void *user) {
    const classifier__goal *goal = (const classifier__goal *)user;
    return classifier__weighted(goal->model, riddle_exp(ln_x), 1.0, NULL) - goal->t;
}

/* Returns the cut size by eq 6 with the model's mean values, the start of a search for the cut. */
static inline double classifier__typical_cut(const classifier_model *m) {
    const classifier_def *d = &m->def;
    classifier_balance at;
    at.fluid_density = d->fluid_density;
    at.viscosity = d->viscosity;
    at.particle_density = d->particle_density;
    at.radius = m->mean_radius;
    at.radial_velocity = d->radial_factor * classifier_radial_velocity(&d->wheel, d->air_flow, m->mean_radius);
    at.tangential_velocity =
        d->rpm * RIDDLE_PI / 30.0 * m->mean_radius * (1.0 + 0.8 * classifier_distribution_mean(&d->restitution));
    at.buoyancy = d->buoyancy;
    return classifier_cut_size(
        &at,
        classifier__model_drag(d, classifier__sphericity_3d(d, classifier_distribution_mean(&d->sphericity_2d), NULL)),
        NULL);
}

CLASSIFIER_API double classifier_quantile(const classifier_model *model, double t) {
    if (!(model && model->data && t > 0.0 && t < 1.0)) return classifier__nan();
    classifier__goal goal;
    goal.model = model;
    goal.t = t;
    goal.x = 0.0;
    return classifier__find(classifier__quantile_gap, &goal, model->def.size_low, model->def.size_high,
                            classifier__typical_cut(model), 0.2);
}

/* Finds the quantile where the approach is computed for the size itself. The cut depends only weakly on the size in the
   approach: the secant method converges in three or four steps. */
CLASSIFIER_API classifier_status classifier_quantile_in_gas(const classifier_def *def, double t,
                                                            const classifier_weights *case_weights,
                                                            const classifier_memory *memory, double *x) {
    double size = 0.0, before = 0.0, gap = 0.0;
    if (x) *x = classifier__nan();
    if (!(def && x && t > 0.0 && t < 1.0)) return CLASSIFIER_BAD_ARGUMENT;
    for (int step = 0; step < 30; step++) {
        classifier_def with = *def;
        classifier_model model;
        with.approach_size = size;
        classifier_status status = classifier_init(&model, &with, memory);
        if (status != CLASSIFIER_OK) return status;
        if (case_weights) model.weights = *case_weights;
        double found = classifier_quantile(&model, t), off = found - size;
        classifier_free(&model);
        if (!(found > 0.0)) return CLASSIFIER_OUTSIDE;
        if (fabs(off) <= 1e-9 * found) {
            *x = found;
            return CLASSIFIER_OK;
        }
        double next = step > 1 && off != gap ? size - off * (size - before) / (off - gap) : found;
        before = size, gap = off;
        size = next > 0.5 * found && next < 2.0 * found ? next : found;
    }
    return CLASSIFIER_OUTSIDE;
}

CLASSIFIER_API classifier_status classifier_separate(const classifier_model *model, const double *x, double *t, int n,
                                                     classifier_result *result) {
    const double nan = classifier__nan();
    classifier_result r = {nan, nan, nan, nan, nan, nan, nan, nan, nan, nan, {nan, nan, nan}, nan, nan, 0};
    bool fine = model && model->data && result && n >= 0 && (n == 0 || (x && t));
    for (int i = 0; i < n && fine; i++) fine = classifier__positive(x[i]);
    if (result) *result = r;
    if (!fine) return classifier__leave(CLASSIFIER_BAD_ARGUMENT, n, t);
    const classifier_def *d = &model->def;
    double error, cut[3], wanted[] = {0.25, 0.5, 0.75};
    r.t_error = 0.0;
    for (int i = 0; i < n; i++) {
        t[i] = classifier_tromp(model, x[i], &error);
        if (error > r.t_error) r.t_error = error;
    }
    r.flags = model->flags;
    for (int k = 0; k < 3; k++) {
        cut[k] = classifier_quantile(model, wanted[k]);
        if (!(cut[k] > 0.0)) {
            r.flags |= (unsigned)CLASSIFIER_CUT_OUTSIDE;
            continue;
        }
        (void)classifier_tromp(model, cut[k], &error);
        if (error > r.t_error) r.t_error = error;
        if (k == 1)
            r.x50_error = error * cut[k] * 0.02 /
                          (classifier_tromp(model, cut[k] * 1.01, NULL) - classifier_tromp(model, cut[k] * 0.99, NULL));
    }
    double re = d->fluid_density * d->radial_factor *
                classifier_radial_velocity(&d->wheel, d->air_flow, model->mean_radius) / d->viscosity;
    r.x25 = cut[0];
    r.x50 = cut[1];
    r.x75 = cut[2];
    r.sharpness = cut[0] / cut[2];
    r.ecart_probable = 0.5 * (cut[2] - cut[0]);
    r.re25 = re * cut[0];
    r.re50 = re * cut[1];
    r.re75 = re * cut[2];
    if ((d->law == CLASSIFIER_SCHILLER_NAUMANN && !(r.re75 <= 1000.0)) ||
        (d->law == CLASSIFIER_STOKES && !(r.re75 <= 0.1)))
        r.flags |= (unsigned)CLASSIFIER_REYNOLDS_OUTSIDE;
    r.weights = model->weights;
    r.clamped = model->clamped;
    r.missed = model->missed;
    *result = r;
    return CLASSIFIER_OK;
}

/* Returns the target less T, which falls with the gas velocity, so that the search has a rising function. */
static inline double classifier__calibration_gap(double ln_factor, const void *user) {
    const classifier__goal *goal = (const classifier__goal *)user;
    return goal->t - classifier__weighted(goal->model, goal->x, riddle_exp(ln_factor), NULL);
}

CLASSIFIER_API classifier_status classifier_calibrate(const classifier_def *def, double x50,
                                                      const classifier_memory *memory, classifier_def *calibrated) {
    if (!(calibrated && classifier__positive(x50))) return CLASSIFIER_BAD_ARGUMENT;
    classifier_model model;
    classifier_status status = classifier_init(&model, def, memory);
    if (status != CLASSIFIER_OK) return status;
    classifier__goal goal;
    goal.model = &model;
    goal.t = 0.5;
    goal.x = x50;
    double factor = classifier__find(classifier__calibration_gap, &goal, 1e-3, 1e3, 1.0, 0.2);
    classifier_free(&model);
    if (!(factor > 0.0)) return CLASSIFIER_OUTSIDE;
    *calibrated = *def;
    calibrated->radial_factor *= factor;
    return CLASSIFIER_OK;
}

CLASSIFIER_API classifier_status classifier_air_flow_for(const classifier_def *def, double x50,
                                                         const classifier_memory *memory, double *air_flow) {
    classifier_def calibrated;
    if (!air_flow) return CLASSIFIER_BAD_ARGUMENT;
    /* flow and factor only occur as a product */
    classifier_status status = classifier_calibrate(def, x50, memory, &calibrated);
    if (status == CLASSIFIER_OK) *air_flow = def->air_flow * (calibrated.radial_factor / def->radial_factor);
    return classifier__leave(status, 1, air_flow);
}

typedef struct classifier__speed_goal {
    const classifier_def *def;
    const classifier_memory *memory;
    double x;
    classifier_status *status;
} classifier__speed_goal;
static inline double classifier__speed_gap(double ln_rpm, const void *user) {
    const classifier__speed_goal *goal = (const classifier__speed_goal *)user;
    classifier_def def = *goal->def;
    classifier_model model;
    if (*goal->status != CLASSIFIER_OK) return classifier__nan(); /* the first bad status stays */
    def.rpm = riddle_exp(ln_rpm);
    *goal->status = classifier_init(&model, &def, goal->memory);
    if (*goal->status != CLASSIFIER_OK) return classifier__nan();
    double gap = classifier__weighted(&model, goal->x, 1.0, NULL) - 0.5;
    classifier_free(&model);
    return gap;
}

CLASSIFIER_API classifier_status classifier_rpm_for(const classifier_def *def, double x50,
                                                    const classifier_memory *memory, double *rpm) {
    classifier_status status = classifier_check_def(def, NULL);
    if (status == CLASSIFIER_OK && !(rpm && classifier__positive(x50))) status = CLASSIFIER_BAD_ARGUMENT;
    if (status != CLASSIFIER_OK) return classifier__leave(status, 1, rpm);
    classifier__speed_goal goal = {def, memory, x50, &status};
    double found = classifier__find(classifier__speed_gap, &goal, 1.0, 1e6, def->rpm, 0.2);
    if (status == CLASSIFIER_OK && !(found > 0.0)) status = CLASSIFIER_OUTSIDE;
    if (status == CLASSIFIER_OK) *rpm = found;
    return classifier__leave(status, 1, rpm);
}

typedef struct classifier__fines {
    const classifier_def *def;
    const classifier_wish *wish;
    const classifier_memory *memory;
    classifier_status status;
} classifier__fines;

/* Computes ln(size / wanted size) and the yield of the fine product, with the air flow times `factor`. Classes are cut
   into four, evenly in ln x (the first one from 0 in x), and are uniform within a piece. */
static inline double classifier__fines_of(const classifier_model *m, const classifier_wish *wish, double factor,
                                          double *yield) {
    const int pieces = 4;
    double sum = 0.0, target = 0.0, size = 0.0;
    for (int pass = 0; pass < 2; pass++) { /* the yield, then the size with the wanted share below it */
        double below = 0.0;
        for (int i = 0; i < wish->classes; i++) {
            const double low = wish->edge[i], high = wish->edge[i + 1];
            double from = low;
            for (int k = 1; k <= pieces && wish->feed[i] > 0.0; k++) {
                const double to = low > 0.0 ? low * riddle_exp(riddle_log(high / low) * k / pieces) : high * k / pieces,
                             middle = from > 0.0 ? sqrt(from * to) : 0.5 * to,
                             mass = wish->feed[i] / pieces * (1.0 - classifier__weighted(m, middle, factor, NULL));
                if (pass == 1 && below + mass >= target) {
                    size = from + (to - from) * (mass > 0.0 ? (target - below) / mass : 0.0);
                    return riddle_log(size / wish->size);
                }
                below += mass;
                from = to;
            }
        }
        if (pass == 0) sum = below, target = wish->share * sum, *yield = sum;
    }
    return HUGE_VAL; /* by rounding, or without any fines */
}

/* Returns ln(size / wanted size) at a speed [1/min] and air flow [m3/s]; NaN if the model cannot be made. */
static inline double classifier__fines_at(classifier__fines *f, double rpm, double air_flow, double *yield,
                                          double *x50) {
    classifier_def def = *f->def;
    classifier_model model;
    *yield = classifier__nan();
    def.rpm = rpm, def.air_flow = air_flow;
    if (f->status == CLASSIFIER_OK) f->status = classifier_init(&model, &def, f->memory);
    if (f->status != CLASSIFIER_OK) return classifier__nan();
    const double miss = classifier__fines_of(&model, f->wish, 1.0, yield);
    if (x50) *x50 = classifier_quantile(&model, 0.5);
    classifier_free(&model);
    return miss;
}

/* Finds the air flow that gives the wanted size at a speed; more air makes coarser fines. The nearest limit where
   there is none. */
static inline double classifier__air_at(classifier__fines *f, double rpm, double *yield) {
    const classifier_wish *wish = f->wish;
    classifier_def def = *f->def;
    classifier_model model;
    double low = riddle_log(wish->air_low), high = riddle_log(wish->air_high), found = low;
    *yield = classifier__nan();
    def.rpm = rpm, def.air_flow = wish->air_low;
    if (f->status == CLASSIFIER_OK) f->status = classifier_init(&model, &def, f->memory);
    if (f->status != CLASSIFIER_OK) return classifier__nan();
    double at_low = classifier__fines_of(&model, wish, 1.0, yield),
           at_high = classifier__fines_of(&model, wish, riddle_exp(high - low), yield);
    if (!(at_low < 0.0)) high = low;
    else if (!(at_high > 0.0)) low = high;
    for (int k = 0; k < 60 && high - low > 1e-9; k++) { /* false position, every third time by halves */
        const double share = at_high < HUGE_VAL && k % 3 != 2 ? at_low / (at_low - at_high) : 0.5,
                     at = low + (share > 0.02 ? (share < 0.98 ? share : 0.98) : 0.02) * (high - low),
                     miss = classifier__fines_of(&model, wish, riddle_exp(at - riddle_log(wish->air_low)), yield);
        if (miss < 0.0) low = at, at_low = miss;
        else high = at, at_high = miss;
        if (fabs(miss) < 1e-10) low = high = at;
    }
    found = 0.5 * (low + high);
    (void)classifier__fines_of(&model, wish, riddle_exp(found - riddle_log(wish->air_low)), yield);
    classifier_free(&model);
    return riddle_exp(found);
}

/* Finds the speed that gives the wanted size with an air flow; a higher one makes finer fines. The nearest limit where
   there is none. */
static inline double classifier__speed_at(classifier__fines *f, double air_flow) {
    double low = riddle_log(f->wish->rpm_low), high = riddle_log(f->wish->rpm_high), yield;
    if (!(classifier__fines_at(f, riddle_exp(low), air_flow, &yield, NULL) > 0.0)) high = low;
    else if (!(classifier__fines_at(f, riddle_exp(high), air_flow, &yield, NULL) < 0.0)) low = high;
    for (int k = 0; k < 40 && high - low > 1e-9; k++) {
        const double middle = 0.5 * (low + high);
        if (classifier__fines_at(f, riddle_exp(middle), air_flow, &yield, NULL) > 0.0) low = middle;
        else high = middle;
    }
    return riddle_exp(0.5 * (low + high));
}

static inline classifier_status classifier__check_wish(const classifier_wish *w) {
    double sum = 0.0;
    if (!(w && w->edge && w->feed)) return CLASSIFIER_BAD_ARGUMENT;
    if (w->classes < 1) return CLASSIFIER_EMPTY;
    if (!(classifier__positive(w->size) && w->share > 0.0 && w->share < 1.0)) return CLASSIFIER_BAD_ARGUMENT;
    if (!(w->rpm_low > 0.0 && w->rpm_low <= w->rpm_high && w->rpm_high <= 1e9)) return CLASSIFIER_BAD_ARGUMENT;
    if (!(w->air_low > 0.0 && w->air_low <= w->air_high && w->air_high < HUGE_VAL)) return CLASSIFIER_BAD_ARGUMENT;
    if (w->yield == w->yield && !(w->yield > 0.0 && w->yield < 1.0)) return CLASSIFIER_BAD_ARGUMENT;
    if (!(w->edge[0] >= 0.0)) return CLASSIFIER_BAD_ARGUMENT;
    for (int i = 0; i < w->classes; i++) {
        if (!(w->edge[i + 1] < HUGE_VAL && w->feed[i] >= 0.0 && w->feed[i] < HUGE_VAL)) return CLASSIFIER_BAD_ARGUMENT;
        if (!(w->edge[i + 1] > w->edge[i])) return CLASSIFIER_NOT_SORTED;
        sum += w->feed[i];
    }
    return fabs(sum - 1.0) <= 1e-3 ? CLASSIFIER_OK : CLASSIFIER_NOT_NORMALISED;
}

/* Fills a setting at a speed and an air flow, with its sensitivities. */
static inline void classifier__set(classifier__fines *f, double rpm, double air_flow, classifier_setting *s) {
    const double step = 0.01;
    double yield[2], miss[2];
    s->rpm = rpm, s->air_flow = air_flow;
    s->size = f->wish->size * riddle_exp(classifier__fines_at(f, rpm, air_flow, &s->yield, &s->x50));
    for (int by = 0; by < 2; by++) {
        for (int k = 0; k < 2; k++) {
            const double change = riddle_exp(k ? step : -step);
            miss[k] =
                classifier__fines_at(f, by ? rpm : rpm * change, by ? air_flow * change : air_flow, &yield[k], NULL);
        }
        *(by ? &s->size_by_air : &s->size_by_rpm) = (miss[1] - miss[0]) / (2.0 * step);
        *(by ? &s->yield_by_air : &s->yield_by_rpm) = (yield[1] - yield[0]) / (2.0 * step);
    }
}

static inline void classifier__clear_setting(classifier_setting *s) {
    s->rpm = s->air_flow = s->size = s->yield = s->x50 = s->yield_low = s->yield_high = classifier__nan();
    s->size_by_rpm = s->size_by_air = s->yield_by_rpm = s->yield_by_air = classifier__nan();
}

CLASSIFIER_API classifier_status classifier_for(const classifier_def *def, const classifier_wish *wish,
                                                const classifier_memory *memory, classifier_setting *setting) {
    if (!setting) return CLASSIFIER_BAD_ARGUMENT;
    classifier__clear_setting(setting);
    classifier__fines f = {def, wish, memory, classifier_check_def(def, NULL)};
    if (f.status == CLASSIFIER_OK) f.status = classifier__check_wish(wish);
    if (f.status != CLASSIFIER_OK) return f.status;
    const bool any_yield = wish->yield != wish->yield; /* NaN */
    const double wanted_air = def->air_flow < wish->air_low    ? wish->air_low
                              : def->air_flow > wish->air_high ? wish->air_high
                                                               : def->air_flow;
    double yield, at[2], yields[2], missed = 0.0;
    classifier_status answer = CLASSIFIER_OK;
    if (any_yield) {
        classifier__set(&f, classifier__speed_at(&f, wanted_air), wanted_air, setting);
        setting->yield_low = setting->yield_high = setting->yield;
        missed = setting->size / wish->size - 1.0;
    } else { /* the slowest and the fastest speed that give the size, then between them */
        for (int k = 0; k < 2; k++) {
            const double rpm = classifier__speed_at(&f, k ? wish->air_high : wish->air_low),
                         air = classifier__air_at(&f, rpm, &yields[k]);
            const double miss = classifier__fines_at(&f, rpm, air, &yield, NULL);
            at[k] = rpm, missed = fabs(miss) > fabs(missed) ? miss : missed;
        }
        setting->yield_low = yields[0] < yields[1] ? yields[0] : yields[1];
        setting->yield_high = yields[0] < yields[1] ? yields[1] : yields[0];
        double low = riddle_log(at[0]), high = riddle_log(at[1]);
        const double rises = yields[1] >= yields[0] ? 1.0 : -1.0;
        if (!(rises * (wish->yield - yields[0]) > 0.0))
            high = low, answer = wish->yield == yields[0] ? CLASSIFIER_OK : CLASSIFIER_OUTSIDE;
        else if (!(rises * (yields[1] - wish->yield) > 0.0))
            low = high, answer = wish->yield == yields[1] ? CLASSIFIER_OK : CLASSIFIER_OUTSIDE;
        for (int k = 0; k < 30 && high - low > 1e-6 && f.status == CLASSIFIER_OK; k++) {
            const double middle = 0.5 * (low + high);
            (void)classifier__air_at(&f, riddle_exp(middle), &yield);
            if (rises * (wish->yield - yield) > 0.0) low = middle;
            else high = middle;
        }
        const double rpm = riddle_exp(0.5 * (low + high)), air = classifier__air_at(&f, rpm, &yield);
        classifier__set(&f, rpm, air, setting);
    }
    if (f.status == CLASSIFIER_OK && fabs(missed) < 1e-3) return answer;
    classifier__clear_setting(setting);
    return f.status == CLASSIFIER_OK ? CLASSIFIER_OUTSIDE : f.status;
}

/* >>trajectory ===================================================================================================== */

/* Computes d/dt of {r, v_r outward, v_phi} in the inertial frame: polar acceleration, and drag on the slip against a
   gas that rotates with the wheel and flows inward. */
static inline void classifier__motion(const classifier_def *def, classifier_drag drag, double x, classifier_slip slip,
                                      const double *y, double *rate) {
    double omega = def->rpm * RIDDLE_PI / 30.0, r = y[0];
    double gas = -def->radial_factor * classifier_radial_velocity(&def->wheel, def->air_flow, r);
    double slip_r = gas - y[1], slip_phi = slip == CLASSIFIER_FULL_SLIP ? omega * r - y[2] : 0.0,
           speed = sqrt(slip_r * slip_r + slip_phi * slip_phi);
    double re = def->fluid_density * speed * x / def->viscosity;
    double driving = def->buoyancy ? def->particle_density - def->fluid_density : def->particle_density;
    double per_slip = re > 0.0
                          ? 0.75 * def->fluid_density / (driving * x) * classifier_drag_coefficient(drag, re) * speed
                          : 0.75 * drag.c1 * def->viscosity / (driving * x * x);
    rate[0] = y[1];
    rate[1] = y[2] * y[2] / r + per_slip * slip_r;
    rate[2] = -y[1] * y[2] / r + per_slip * slip_phi;
}

/* Follows a path. Returns 1: it leaves outside; 0: inside; -1: it stays, or arguments are bad; 2: 100 000 steps did not
   reach its end. */
static inline int classifier__follow(const classifier_def *def, classifier_drag drag, double x, double r,
                                     double v_radial, double v_phi, classifier_slip slip) {
    /* Dormand & Prince 1980, order 5 with error estimate of order 4 */
    const double a[7][6] = {{0.0, 0.0, 0.0, 0.0, 0.0, 0.0},
                            {1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0},
                            {3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0},
                            {44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0},
                            {19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0},
                            {9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0},
                            {35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0}};
    const double e[7] = {71.0 / 57600.0,      0.0,          -71.0 / 16695.0, 71.0 / 1920.0,
                         -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0};
    double k[7][3], y[3] = {r, v_radial, v_phi}, t = 0.0, tolerance = 1e-9;
    if (!def || !(classifier__drag_ok(drag) && classifier__positive(x) && r >= def->wheel.inner_radius &&
                  r <= def->wheel.outer_radius && fabs(v_radial) < HUGE_VAL && fabs(v_phi) < HUGE_VAL))
        return -1;
    double omega = def->rpm * RIDDLE_PI / 30.0, end = 20.0 * RIDDLE_PI / omega, h = 1e-3 / omega;
    double tip = omega * def->wheel.outer_radius,
           inward =
               def->radial_factor * classifier_radial_velocity(&def->wheel, def->air_flow, def->wheel.outer_radius),
           scale = tip > inward ? tip : inward;
    classifier__motion(def, drag, x, slip, y, k[0]);
    for (int step = 0; t < end && t + h > t && step < 100000; step++) {
        double next[3] = {0.0, 0.0, 0.0}, worst = 0.0;
        for (int s = 1; s < 7; s++) {
            for (int c = 0; c < 3; c++) {
                next[c] = y[c];
                for (int j = 0; j < s; j++) next[c] += h * a[s][j] * k[j][c];
            }
            if (!(next[0] > 0.5 * def->wheel.inner_radius && next[0] < 2.0 * def->wheel.outer_radius)) {
                worst = HUGE_VAL; /* far too long a step */
                break;
            }
            classifier__motion(def, drag, x, slip, next, k[s]);
        }
        for (int c = 0; c < 3 && worst < HUGE_VAL; c++) {
            double error = 0.0;
            for (int s = 0; s < 7; s++) error += h * e[s] * k[s][c];
            error = fabs(error) / ((c ? scale : def->wheel.outer_radius) * tolerance);
            if (!(error <= worst)) worst = error;
        }
        if (!(worst < HUGE_VAL)) {
            h *= 0.1;
            continue;
        }
        if (worst <= 1.0) {
            t += h;
            for (int c = 0; c < 3; c++) {
                y[c] = next[c];
                k[0][c] = k[6][c];
            }
            if (y[0] >= def->wheel.outer_radius) return 1;
            if (y[0] <= def->wheel.inner_radius) return 0;
        }
        double factor = worst > 0.0 ? 0.9 / riddle_pow(worst, 0.2) : 5.0;
        h *= factor < 0.2 ? 0.2 : factor > 5.0 ? 5.0 : factor;
    }
    return t < end ? 2 : -1;
}

CLASSIFIER_API int classifier_trajectory(const classifier_def *def, classifier_drag drag, double x, double r,
                                         double v_radial, double v_phi, classifier_slip slip) {
    const int fate = classifier__follow(def, drag, x, r, v_radial, v_phi, slip);
    return fate == 2 ? -1 : fate;
}

CLASSIFIER_API double classifier_trajectory_cut(const classifier_def *def, classifier_drag drag, double r, double v_phi,
                                                classifier_slip slip) {
    if (classifier_check_def(def, NULL) != CLASSIFIER_OK) return classifier__nan();
    double low = def->size_low, high = def->size_high;
    if (classifier_trajectory(def, drag, low, r, 0.0, v_phi, slip) == 1 ||
        classifier_trajectory(def, drag, high, r, 0.0, v_phi, slip) != 1)
        return classifier__nan();
    while (high / low > 1.0 + 1e-9) {
        double middle = sqrt(low * high);
        if (classifier_trajectory(def, drag, middle, r, 0.0, v_phi, slip) == 1) high = middle;
        else low = middle;
    }
    return sqrt(low * high);
}

CLASSIFIER_API classifier_status classifier_trajectory_tromp(const classifier_def *def, double x, classifier_slip slip,
                                                             double *t, double *error) {
    classifier_status status = classifier_check_def(def, NULL);
    if (t) *t = classifier__nan();
    if (error) *error = classifier__nan();
    if (status != CLASSIFIER_OK) return status;
    if (!(t && classifier__positive(x))) return CLASSIFIER_BAD_ARGUMENT;
    classifier_weights w;
    (void)classifier_contact_weights(&def->contacts, &w);
    classifier_def drawn = *def;
    drawn.preintegrate = false; /* a path needs every number */
    classifier__recipe recipe = classifier__recipe_of(&drawn);
    classifier__sequence sequence;
    double mean[CLASSIFIER_MAX_SHIFTS], sum = 0.0, squares = 0.0;
    for (int shift = 0; shift < def->shifts; shift++) {
        classifier__sequence_begin(&sequence, def->sampler, def->points, def->seed, shift);
        mean[shift] = 0.0;
        for (int i = 0; i < def->points; i++) {
            double u[CLASSIFIER__DIMENSIONS], line[3][2];
            const double weight[3] = {w.clean, w.thrown, w.again};
            classifier__particle p;
            classifier__sequence_point(&sequence, i, u);
            classifier__draw_particle(&recipe, u, &p);
            if (!p.first.hit) continue;
            classifier__case_lines(&recipe, &p, line);
            for (int k = 0; k < 3; k++) {
                double r = k == 2 && p.second.hit ? p.second.radius : p.first.radius,
                       v = line[k][0] + line[k][1] * (k < 2 ? p.e_first : p.e_last);
                if (!(r < def->wheel.outer_radius)) r = def->wheel.outer_radius;
                const int fate = weight[k] > 0.0 ? classifier__follow(def, p.drag, x, r, 0.0, v, slip) : 0;
                if (fate == 2) return CLASSIFIER_OUTSIDE;
                if (fate == 1) mean[shift] += weight[k] / def->points;
            }
        }
        sum += mean[shift] / def->shifts;
    }
    for (int shift = 0; shift < def->shifts; shift++) squares += (mean[shift] - sum) * (mean[shift] - sum);
    *t = sum;
    if (error) *error = riddle_student(0.95, def->shifts - 1) * sqrt(squares / ((def->shifts - 1.0) * def->shifts));
    return CLASSIFIER_OK;
}

/* >>curves and fits ================================================================================================ */

typedef struct classifier__curve_goal {
    const classifier_curve *curve;
    double t;
} classifier__curve_goal;
static inline double classifier__curve_gap(double ln_x, const void *user) {
    const classifier__curve_goal *goal = (const classifier__curve_goal *)user;
    /* sign turned: falling towards fine sizes */
    return goal->t - classifier_curve_value(goal->curve, riddle_exp(ln_x));
}

static inline double classifier__curve_clean_size(const classifier_curve *c, double t) {
    if (c->law == CLASSIFIER_PLITT) return classifier_plitt_size(t, c->size, c->slope);
    if (c->law == CLASSIFIER_ROSIN_RAMMLER) return classifier_rosin_rammler_size(t, c->size, c->slope);
    return classifier_molerus_hoffmann_size(t, c->size, c->slope);
}

/* Finds the largest gap (least T) between two sizes by golden section, or the first that is not negative. */
static inline double classifier__curve_least(const classifier__curve_goal *goal, double low, double high, double *at) {
    const double golden = 0.6180339887498949;
    double a = high - golden * (high - low), b = low + golden * (high - low), gap_a = classifier__curve_gap(a, goal),
           gap_b = classifier__curve_gap(b, goal);
    for (int i = 0; i < 40 && gap_a < 0.0 && gap_b < 0.0; i++) {
        if (gap_a > gap_b) {
            high = b;
            b = a;
            gap_b = gap_a;
            a = high - golden * (high - low);
            gap_a = classifier__curve_gap(a, goal);
        } else {
            low = a;
            a = b;
            gap_a = gap_b;
            b = low + golden * (high - low);
            gap_b = classifier__curve_gap(b, goal);
        }
    }
    *at = gap_a > gap_b ? a : b;
    return gap_a > gap_b ? gap_a : gap_b;
}

CLASSIFIER_API double classifier_curve_size(const classifier_curve *curve, double t) {
    if (!(curve && t > 0.0 && t < 1.0 && classifier_curve_value(curve, curve->size) >= 0.0)) return classifier__nan();
    double b = curve->bypass;
    if (!(curve->hook_size < HUGE_VAL))
        return t > b ? classifier__curve_clean_size(curve, (t - b) / (1.0 - b)) : classifier__nan();
    double x = classifier__curve_clean_size(curve, t);
    if (x >= curve->hook_size) return x; /* right of the hook there is no bypass */
    classifier__curve_goal goal;
    goal.curve = curve;
    goal.t = t;
    /* from the hook's end down in small steps to the first crossing; where T turns back up, its minimum may lie
       between two steps */
    double ln_hook = riddle_log(curve->hook_size), ln_high = ln_hook, high_gap = classifier__curve_gap(ln_high, &goal);
    if (!(high_gap < 0.0)) return x; /* the hook's end, but for rounding */
    bool falls = true;
    for (int i = 1; i <= 2000; i++) {
        double ln_low = ln_high - 0.01, low_gap = classifier__curve_gap(ln_low, &goal);
        bool turns = falls && low_gap < high_gap;
        if (turns && !(low_gap > 0.0)) {
            double end = i > 1 ? ln_high + 0.01 : ln_hook, ln_least,
                   gap = classifier__curve_least(&goal, ln_low, end, &ln_least);
            if (gap > 0.0) {
                ln_low = ln_least;
                low_gap = gap;
                ln_high = end;
                high_gap = classifier__curve_gap(end, &goal);
            } else if (gap == 0.0) {
                return riddle_exp(ln_least);
            }
        }
        if ((low_gap > 0.0) != (high_gap > 0.0))
            return riddle_exp(classifier__brent(classifier__curve_gap, &goal, ln_low, low_gap, ln_high, high_gap));
        falls = !(low_gap < high_gap);
        ln_high = ln_low;
        high_gap = low_gap;
    }
    return classifier__nan();
}

CLASSIFIER_API double classifier_class_mean(classifier_function t, const void *t_user, classifier_function q,
                                            const void *q_user, double low, double high, int pieces) {
    const double node[5] = {-0.90617984593866399, -0.53846931010568309, 0.0, 0.53846931010568309, 0.90617984593866399};
    const double weight[5] = {0.23692688505618909, 0.47862867049936647, 0.56888888888888889, 0.47862867049936647,
                              0.23692688505618909};
    double above = 0.0, below = 0.0, half = 0.5 * (high - low) / pieces;
    if (!(t && pieces >= 1 && half > 0.0 && half < HUGE_VAL)) return classifier__nan();
    for (int piece = 0; piece < pieces; piece++) {
        for (int i = 0; i < 5; i++) {
            double x = low + half * (2.0 * piece + 1.0 + node[i]), density = q ? q(x, q_user) : 1.0;
            above += weight[i] * density * t(x, t_user);
            below += weight[i] * density;
        }
    }
    return below > 0.0 ? above / below : classifier__nan();
}

/* Parameters without bounds, so that every step is legal: ln size, ln slope, logit bypass, ln hook */
static inline classifier_curve classifier__curve_from(const classifier_curve *like, const double *p) {
    classifier_curve c = *like;
    c.size = riddle_exp(p[0]);
    c.slope = riddle_exp(p[1]);
    if (c.bypass > 0.0) c.bypass = 1.0 / (1.0 + riddle_exp(-p[2]));
    if (c.hook_size < HUGE_VAL) c.hook_size = riddle_exp(p[3]);
    return c;
}

/* Solves a x = b for symmetric positive definite a[n][4], n <= 4, by Cholesky's method. Returns false if a is not
   positive definite. */
static inline bool classifier__solve_spd(double a[4][4], double *b, int n) {
    for (int j = 0; j < n; j++) {
        for (int k = 0; k < j; k++) a[j][j] -= a[j][k] * a[j][k];
        if (!(a[j][j] > 0.0)) return false;
        a[j][j] = sqrt(a[j][j]);
        for (int i = j + 1; i < n; i++) {
            for (int k = 0; k < j; k++) a[i][j] -= a[i][k] * a[j][k];
            a[i][j] /= a[j][j];
        }
    }
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < i; k++) b[i] -= a[i][k] * b[k];
        b[i] /= a[i][i];
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int k = i + 1; k < n; k++) b[i] -= a[k][i] * b[k];
        b[i] /= a[i][i];
    }
    return true;
}

/* Returns the sum of squared residuals of the curve. With normal != NULL, also computes J'J and J'r over the free
   parameters by central differences. */
static inline double classifier__fit_squares(const classifier_curve *like, const double *p, const int *free, int n_free,
                                             const double *x, const double *t, const double *sd, int n,
                                             double normal[4][4], double *gradient) {
    double sum = 0.0, step = 1e-5;
    classifier_curve c = classifier__curve_from(like, p), up[4], down[4];
    for (int j = 0; normal && j < n_free; j++) {
        double q[4] = {p[0], p[1], p[2], p[3]};
        q[free[j]] = p[free[j]] + step;
        up[j] = classifier__curve_from(like, q);
        q[free[j]] = p[free[j]] - step;
        down[j] = classifier__curve_from(like, q);
        gradient[j] = 0.0;
        for (int k = 0; k < n_free; k++) normal[j][k] = 0.0;
    }
    for (int i = 0; i < n; i++) {
        double weight = sd ? 1.0 / sd[i] : 1.0, r = (t[i] - classifier_curve_value(&c, x[i])) * weight, slope[4];
        sum += r * r;
        for (int j = 0; normal && j < n_free; j++) {
            slope[j] =
                (classifier_curve_value(&up[j], x[i]) - classifier_curve_value(&down[j], x[i])) * weight / (2.0 * step);
            gradient[j] += slope[j] * r;
            for (int k = 0; k <= j; k++) normal[j][k] += slope[j] * slope[k];
        }
    }
    return sum;
}

/* Measured points, and a set of parameters that is fitted to them: `like` says which there are. */
typedef struct classifier__fit_data {
    const double *x, *t, *sd;
    int n;
} classifier__fit_data;
typedef struct classifier__fit_try {
    classifier_curve like;
    double p[4], squares;
    int free[4], n_free, iterations;
} classifier__fit_try;

static inline double classifier__try_squares(const classifier__fit_try *f, const double *p,
                                             const classifier__fit_data *d, double normal[4][4], double *gradient) {
    return classifier__fit_squares(&f->like, p, f->free, f->n_free, d->x, d->t, d->sd, d->n, normal, gradient);
}

/* Computes the step of Levenberg and Marquardt, no longer than 1 in any parameter. Returns false if there is none. */
static inline bool classifier__fit_step(const classifier__fit_try *f, double normal[4][4], const double *gradient,
                                        double damping, double *step, double *length) {
    double a[4][4];
    for (int i = 0; i < f->n_free; i++) {
        step[i] = gradient[i];
        for (int j = 0; j <= i; j++) a[i][j] = normal[i][j] * (i == j ? 1.0 + damping : 1.0) + (i == j ? 1e-300 : 0.0);
    }
    *length = 0.0;
    if (!classifier__solve_spd(a, step, f->n_free)) return false;
    for (int i = 0; i < f->n_free; i++)
        if (fabs(step[i]) > *length) *length = fabs(step[i]);
    for (int i = 0; i<f->n_free && * length> 1.0; i++) step[i] /= *length;
    return *length < HUGE_VAL;
}

/* Goes on from f->p along a narrow, curved valley, as one makes that pins the curve at a point with a small deviation.
   Damped steps creep there: this takes steps without damping, each followed by damped ones that lead back
   to the floor. */
static inline void classifier__follow_valley(classifier__fit_try *f, const classifier__fit_data *d) {
    double normal[4][4], gradient[4], step[4], back[4], length;
    for (int round = 0; round < 100; round++) {
        const double before = classifier__try_squares(f, f->p, d, normal, gradient);
        if (!classifier__fit_step(f, normal, gradient, 0.0, step, &length) || length < 1e-9) return;
        bool lower = false;
        for (double share = 1.0; share > 1e-4 && !lower; share *= 0.5) {
            double q[4] = {f->p[0], f->p[1], f->p[2], f->p[3]};
            for (int i = 0; i < f->n_free; i++) q[f->free[i]] += share * step[i];
            for (int k = 0; k < 4; k++) {
                if (!(classifier__try_squares(f, q, d, normal, gradient) < HUGE_VAL)) break;
                if (!classifier__fit_step(f, normal, gradient, 1e-3, back, &length)) break;
                for (int i = 0; i < f->n_free; i++) q[f->free[i]] += back[i];
            }
            f->squares = classifier__try_squares(f, q, d, NULL, NULL);
            lower = f->squares < before * (1.0 - 1e-12);
            for (int i = 0; i < 4 && lower; i++) f->p[i] = q[i];
        }
        if (lower) continue;
        f->squares = before;
        return;
    }
}

/* Goes down from f->p until no step leads further; at most 200 steps. */
static inline void classifier__descend(classifier__fit_try *f, const classifier__fit_data *d) {
    double normal[4][4], gradient[4], damping = 1e-3;
    bool arrived = false;
    for (f->iterations = 0; f->iterations < 200 && !arrived; f->iterations++) {
        f->squares = classifier__try_squares(f, f->p, d, normal, gradient);
        for (int tries = 0; tries < 40 && !arrived; tries++) {
            double step[4], q[4] = {f->p[0], f->p[1], f->p[2], f->p[3]}, length, now = HUGE_VAL;
            const bool solved = classifier__fit_step(f, normal, gradient, damping, step, &length);
            for (int i = 0; i < f->n_free && solved; i++) q[f->free[i]] += step[i];
            if (solved) now = classifier__try_squares(f, q, d, NULL, NULL);
            if (now <= f->squares) {
                for (int i = 0; i < 4; i++) f->p[i] = q[i];
                damping = damping > 1e-12 ? damping * 0.1 : damping;
                arrived = length < 1e-9 || f->squares - now <= 1e-15 * f->squares || fabs(f->p[2]) > 40.0;
                f->squares = now;
                break;
            }
            damping *= 10.0;
            arrived = tries == 39 || (solved && length < 1e-9);
        }
    }
    if (d->sd) classifier__follow_valley(f, d);
}

static inline classifier__fit_try classifier__fit_begin(const classifier__fit_try *from, bool bypass, bool hook,
                                                        double logit_bypass, double ln_hook) {
    classifier__fit_try f = *from;
    f.free[0] = 0, f.free[1] = 1, f.free[2] = 2, f.free[3] = 3;
    f.n_free = 2 + (bypass ? 1 : 0) + (hook ? 1 : 0);
    f.like.bypass = bypass ? 0.5 : 0.0;
    f.like.hook_size = hook ? 1.0 : HUGE_VAL;
    f.p[2] = logit_bypass, f.p[3] = ln_hook;
    return f;
}

/* Takes the better of two; the one with more parameters only if it is better by more than rounding. */
static inline void classifier__fit_take(classifier__fit_try *best, const classifier__fit_try *other) {
    if (other->squares < best->squares * (1.0 - 1e-12)) *best = *other;
}

/* Returns the least of the sizes above x; HUGE_VAL if there is none. */
static inline double classifier__size_above(const classifier__fit_data *d, double x) {
    double above = HUGE_VAL;
    for (int j = 0; j < d->n; j++)
        if (d->x[j] > x && d->x[j] < above) above = d->x[j];
    return above;
}

/* Takes a step between two sizes where that is better: the border of infinite slope, which a descent from a gentle
   slope may miss. */
static inline void classifier__fit_steps(classifier__fit_try *best, const classifier__fit_data *d, bool bypass) {
    for (int i = 0; i < d->n; i++) {
        const double low = d->x[i], above = classifier__size_above(d, low);
        double sum = 0.0, weights = 0.0;
        if (!(above < HUGE_VAL)) continue;
        for (int j = 0; j < d->n; j++) {
            const double weight = d->sd ? 1.0 / (d->sd[j] * d->sd[j]) : 1.0;
            if (d->x[j] <= low) sum += weight * d->t[j], weights += weight;
        }
        const double share = sum / weights < 0.99 ? sum / weights : 0.99;
        for (int k = 0; k < (bypass && share > 1e-7 ? 2 : 1); k++) {
            classifier__fit_try f =
                classifier__fit_begin(best, k == 1, false, k ? riddle_log(share / (1.0 - share)) : 0.0, 0.0);
            f.p[0] = 0.5 * (riddle_log(low) + riddle_log(above));
            f.p[1] = riddle_log(
                60.0 / (f.like.law == CLASSIFIER_MOLERUS_HOFFMANN ? 1.0 - low / above : riddle_log(above / low)));
            f.squares = classifier__try_squares(&f, f.p, d, NULL, NULL);
            if (!(f.squares < best->squares)) continue;
            classifier__descend(&f, d);
            f.iterations += best->iterations;
            classifier__fit_take(best, &f);
        }
    }
}

/* Takes the curve of Molerus & Hoffmann where it is better from other starts: the best of a grid of sizes and
   slopes, 0 among them. */
static inline void classifier__fit_from_grid(classifier__fit_try *best, const classifier__fit_data *d, bool bypass) {
    const double slopes[4] = {-40.0, -1.0, 0.5, 2.0};
    double least = HUGE_VAL, most = 0.0;
    if (best->like.law != CLASSIFIER_MOLERUS_HOFFMANN) return;
    for (int i = 0; i < d->n; i++) least = d->x[i] < least ? d->x[i] : least, most = d->x[i] > most ? d->x[i] : most;
    const double from = riddle_log(0.2 * least), way = riddle_log(5.0 * most) - from;
    for (int k = 0; k < (bypass ? 12 : 4); k++) {
        classifier__fit_try start = *best;
        start.squares = HUGE_VAL;
        for (int i = 0; i < 24; i++) {
            classifier__fit_try f = classifier__fit_begin(best, k >= 4, false, k < 8 ? -2.0 : 1.0, 0.0);
            /* the first: far below all, T = 1 */
            f.p[0] = i == 0 ? from - 14.0 : from + way * i / 23.0, f.p[1] = slopes[k % 4];
            f.squares = classifier__try_squares(&f, f.p, d, NULL, NULL);
            if (f.squares < start.squares) start = f;
        }
        classifier__descend(&start, d);
        start.iterations += best->iterations;
        if (start.n_free < 3 || start.p[2] > -16.0) classifier__fit_take(best, &start);
    }
}

/* Returns whether a constant T fits the points as well: they leave the cut size open. */
static inline bool classifier__is_flat(const classifier__fit_try *best, const classifier__fit_data *d) {
    double sum = 0.0, weights = 0.0, squares = 0.0;
    for (int i = 0; i < d->n; i++) {
        const double weight = d->sd ? 1.0 / (d->sd[i] * d->sd[i]) : 1.0;
        sum += weight * d->t[i], weights += weight;
    }
    for (int i = 0; i < d->n; i++) {
        const double miss = (d->t[i] - sum / weights) / (d->sd ? d->sd[i] : 1.0);
        squares += miss * miss;
    }
    return !(best->squares < squares * (1.0 - 1e-9));
}

/* Returns the number of distinct sizes, counted up to `most`. */
static inline int classifier__distinct(const double *x, int n, int most) {
    int count = 0;
    for (int i = 0; i < n && count < most; i++) {
        bool is_new = true;
        for (int j = 0; j < i && is_new; j++) is_new = x[j] != x[i];
        count += is_new;
    }
    return count;
}

/* Returns whether the points are in their ranges, with deviations similar enough for the fit to use all of them. */
static inline bool classifier__fit_accepts(const classifier__fit_data *d) {
    double least = HUGE_VAL, most = 0.0;
    if (!(d->x && d->t && d->n > 0)) return false;
    for (int i = 0; i < d->n; i++) {
        if (!(classifier__positive(d->x[i]) && fabs(d->t[i]) < HUGE_VAL && (!d->sd || classifier__positive(d->sd[i]))))
            return false;
        if (d->sd) least = d->sd[i] < least ? d->sd[i] : least, most = d->sd[i] > most ? d->sd[i] : most;
    }
    return !d->sd || (least > 1e-100 && most < 1e100 && most <= 1e6 * least);
}

/* Sets the start of a fit with this bypass, or with none (0): the size by interpolation where T without the bypass is
   one half, the slope as the best of a few. Returns false if the points are not on both sides of that. */
static inline bool classifier__fit_start(classifier__fit_try *f, classifier_curve_law law,
                                         const classifier__fit_data *d, double bypass) {
    const double half = 0.5 * (1.0 + bypass);
    double at_low = 0.0, at_high = HUGE_VAL, t_low = 0.0, t_high = 1.0, best = HUGE_VAL, first = 0.0;
    bool is_below = false, is_above = false;
    for (int i = 0; i < d->n; i++) {
        is_below |= d->t[i]<half, is_above |= d->t[i]> half;
        if (d->t[i] < half && d->x[i] > at_low) at_low = d->x[i], t_low = d->t[i];
    }
    for (int i = 0; i < d->n; i++)
        if (d->t[i] >= half && d->x[i] > at_low && d->x[i] < at_high) at_high = d->x[i], t_high = d->t[i];
    f->squares = HUGE_VAL;
    f->like = classifier_curve_of(law, 1.0, 1.0);
    if (!(is_below && is_above)) return false;
    double size = at_low;
    if (at_high < HUGE_VAL)
        size = riddle_exp(riddle_log(at_low) +
                          (half - t_low) / (t_high - t_low) * (riddle_log(at_high) - riddle_log(at_low)));
    f->p[0] = riddle_log(size);
    *f = classifier__fit_begin(f, bypass > 0.0, false, bypass > 0.0 ? riddle_log(bypass / (1.0 - bypass)) : 0.0, 0.0);
    for (int i = 0; i < 12; i++) {
        f->p[1] = riddle_log(0.5) + 0.35 * i;
        double squares = classifier__try_squares(f, f->p, d, NULL, NULL);
        if (squares < best) best = squares, first = f->p[1];
    }
    f->p[1] = first;
    return true;
}

/* Finds the best curve with a bypass, starting from the least T of the points and from smaller ones; a result at the
   bound counts as no bypass. */
static inline void classifier__fit_bypass(classifier__fit_try *best, const classifier__fit_data *d, double floor_t) {
    const double starts[4] = {floor_t, 0.01, 0.1, 0.8 * floor_t};
    const int iterations = best->iterations;
    for (int k = 0; k < 4; k++) {
        classifier__fit_try f;
        memset(&f, 0, sizeof f);
        if (!classifier__fit_start(&f, best->like.law, d, starts[k])) continue;
        classifier__descend(&f, d);
        f.iterations += iterations;
        if (f.p[2] > -16.0) classifier__fit_take(best, &f); /* below 1e-7: the border */
    }
}

/* Finds the best curve with a hook. The sum of squares has a kink at every size, so there are starts between each two:
   from the best curve so far, and from the least T and the T of the smallest size as bypass. A result at the bound
   counts as no hook. */
static inline void classifier__fit_hook(classifier__fit_try *best, const classifier__fit_data *d, double floor_t) {
    classifier__fit_try start[3];
    const int iterations = best->iterations;
    int smallest = 0;
    bool is_start[3] = {true, false, false};
    for (int i = 0; i < d->n; i++) smallest = d->x[i] < d->x[smallest] ? i : smallest;
    const double t = d->t[smallest], floors[3] = {floor_t, floor_t, t > 0.1 ? (t < 0.99 ? t : 0.99) : 0.1};
    start[0] = *best;
    for (int k = 1; k < 3; k++) {
        memset(&start[k], 0, sizeof start[k]);
        is_start[k] = classifier__fit_start(&start[k], best->like.law, d, k == 1 ? floor_t : 0.0);
    }
    for (int i = 0; i < d->n; i++) {
        const double above = classifier__size_above(d, d->x[i]);
        if (!(above < HUGE_VAL)) continue;
        for (int k = 0; k < 3; k++) {
            if (!is_start[k]) continue;
            classifier__fit_try f =
                classifier__fit_begin(&start[k], true, true, riddle_log(floors[k] / (1.0 - floors[k])),
                                      0.5 * (riddle_log(d->x[i]) + riddle_log(above)));
            classifier__descend(&f, d);
            f.iterations += iterations;
            if (f.p[2] > -16.0) classifier__fit_take(best, &f);
        }
    }
}

/* Returns whether parameter k is free and may grow by `way` at the same cut size without a change of T at the points,
   as the slope of a step between two sizes. */
static inline bool classifier__is_open(const classifier__fit_try *f, const classifier__fit_data *d, int k, double way) {
    double q[4] = {f->p[0], f->p[1], f->p[2], f->p[3]};
    bool is_free = false;
    for (int j = 0; j < f->n_free; j++) is_free |= f->free[j] == k;
    q[k] += way;
    const classifier_curve best = classifier__curve_from(&f->like, f->p);
    classifier_curve other = classifier__curve_from(&f->like, q);
    other.size *= k == 1 ? classifier__curve_clean_size(&best, 0.5) / classifier__curve_clean_size(&other, 0.5) : 1.0;
    for (int i = 0; i < d->n && is_free; i++)
        if (!(fabs(classifier_curve_value(&other, d->x[i]) - classifier_curve_value(&best, d->x[i])) < 1e-6))
            return false;
    return is_free;
}

/* Deviations from the curvature at the best place: the diagonal of the inverse, column by column. */
static inline void classifier__fit_deviations(const classifier__fit_try *f, const classifier__fit_data *d,
                                              classifier_fit_result *result) {
    double normal[4][4], gradient[4], deviation[4] = {0.0, 0.0, 0.0, 0.0};
    const double squares = classifier__try_squares(f, f->p, d, normal, gradient);
    for (int k = 0; k < f->n_free; k++) {
        double a[4][4], column[4] = {0.0, 0.0, 0.0, 0.0};
        column[k] = 1.0;
        for (int i = 0; i < f->n_free; i++)
            for (int j = 0; j <= i; j++) a[i][j] = normal[i][j];
        const bool known = classifier__solve_spd(a, column, f->n_free) && column[k] >= 0.0;
        deviation[f->free[k]] = known ? sqrt(column[k] * (d->sd ? 1.0 : squares / result->dof)) : HUGE_VAL;
    }
    const classifier_curve *c = &result->curve;
    result->size_sd = classifier__is_open(f, d, 0, 0.01) ? HUGE_VAL : c->size * deviation[0];
    result->slope_sd = classifier__is_open(f, d, 1, RIDDLE_LN2_HI) ? HUGE_VAL
                       : c->slope > 0.0                            ? c->slope * deviation[1]
                                                                   : 0.0;
    result->bypass_sd = c->bypass > 0.0 ? c->bypass * (1.0 - c->bypass) * deviation[2] : 0.0;
    result->hook_sd = c->hook_size < HUGE_VAL ? c->hook_size * deviation[3] : 0.0;
}

/* Ranges of a curve with a bypass: the values that it has in all curves whose sum of squares is below a bound. A hook
   is held at each of many sizes, because the sum has a kink at every measured size; size, slope and bypass then make it
   nearly a quadratic, whose ends are known. The bypass enters linearly and may be negative on the way; where it would
   be, the curve without one counts. */
typedef struct classifier__held {
    classifier_curve like;
    double p[3], squares, inverse[3][3]; /* ln size, ln slope (alpha itself), bypass */
    double per_size;                     /* 1 / size of the hook [1/m]; 0: the bypass is the same for all sizes */
    int n_free;                          /* 2: no bypass */
    bool is_known;                       /* inverse of the normal matrix */
} classifier__held;

static inline classifier_curve classifier__held_curve(const classifier__held *f, const double *p) {
    classifier_curve c = f->like;
    c.size = riddle_exp(p[0]);
    c.slope = f->like.law == CLASSIFIER_MOLERUS_HOFFMANN ? p[1] : riddle_exp(p[1]);
    return c;
}

/* An alpha below 0 is outside the law, but the slopes at 0 need both sides. */
static inline double classifier__held_value(const classifier_curve *c, double x) {
    const double z = x / c->size * (x / c->size);
    if (c->law != CLASSIFIER_MOLERUS_HOFFMANN || !(c->slope < 0.0)) return classifier__curve_clean(c, x);
    return 1.0 / (1.0 + riddle_exp(c->slope * (1.0 - z)) / z);
}

static inline double classifier__held_squares(const classifier__held *f, const double *p, const classifier__fit_data *d,
                                              double normal[4][4], double *gradient) {
    const double step = 1e-5;
    classifier_curve c = classifier__held_curve(f, p), near[2][2];
    double sum = 0.0;
    for (int k = 0; normal && k < 4; k++) {
        double q[3] = {p[0], p[1], p[2]};
        q[k / 2] += k % 2 ? step : -step;
        near[k / 2][k % 2] = classifier__held_curve(f, q);
    }
    for (int k = 0; normal && k < 3; k++) {
        gradient[k] = 0.0;
        for (int j = 0; j < 3; j++) normal[k][j] = 0.0;
    }
    for (int i = 0; i < d->n; i++) {
        const double weight = d->sd ? 1.0 / d->sd[i] : 1.0, x = d->x[i],
                     share = x * f->per_size < 1.0 ? 1.0 - x * f->per_size : 0.0,
                     passes = f->n_free > 2 ? 1.0 - p[2] * share : 1.0, clean = classifier__held_value(&c, x),
                     r = (d->t[i] - (1.0 - passes * (1.0 - clean))) * weight;
        double by[3];
        sum += r * r;
        if (!normal) continue;
        for (int k = 0; k < 2; k++)
            by[k] = weight * passes *
                    (classifier__held_value(&near[k][1], x) - classifier__held_value(&near[k][0], x)) / (2.0 * step);
        by[2] = weight * share * (1.0 - clean);
        for (int k = 0; k < f->n_free; k++) {
            gradient[k] += by[k] * r;
            for (int j = 0; j <= k; j++) normal[k][j] += by[k] * by[j];
        }
    }
    return sum;
}

/* Finds the best curve from f->p, and the inverse of its normal matrix. */
static inline void classifier__held_fit(classifier__held *f, const classifier__fit_data *d) {
    double normal[4][4], gradient[4], damping = 1e-4;
    memset(normal, 0, sizeof normal), memset(gradient, 0, sizeof gradient);
    f->squares = classifier__held_squares(f, f->p, d, normal, gradient);
    for (int round = 0; round < 40; round++) {
        double a[4][4], step[4] = {0.0, 0.0, 0.0, 0.0}, q[3], length = 0.0;
        for (int k = 0; k < f->n_free; k++) {
            step[k] = gradient[k];
            for (int j = 0; j <= k; j++)
                a[k][j] = normal[k][j] * (j == k ? 1.0 + damping : 1.0) + (j == k ? 1e-300 : 0.0);
        }
        const bool solved = classifier__solve_spd(a, step, f->n_free);
        for (int k = 0; k < f->n_free; k++) length = fabs(step[k]) > length ? fabs(step[k]) : length;
        for (int k = 0; k < 3; k++) q[k] = f->p[k] + (length > 1.0 ? step[k] / length : step[k]);
        const double now = solved && length < HUGE_VAL ? classifier__held_squares(f, q, d, NULL, NULL) : HUGE_VAL;
        if (now < f->squares) {
            const bool arrived = f->squares - now <= 1e-9 * f->squares;
            for (int k = 0; k < 3; k++) f->p[k] = q[k];
            f->squares = classifier__held_squares(f, f->p, d, normal, gradient);
            damping *= 0.1;
            if (arrived) break;
        } else if ((damping *= 10.0) > 1e6 || length < 1e-7) {
            break;
        }
    }
    f->is_known = true;
    for (int k = 0; k < f->n_free && f->is_known; k++) {
        double a[4][4], column[4] = {0.0, 0.0, 0.0, 0.0};
        column[k] = 1.0;
        for (int i = 0; i < f->n_free; i++)
            for (int j = 0; j <= i; j++) a[i][j] = normal[i][j];
        f->is_known = classifier__solve_spd(a, column, f->n_free) && column[k] > 0.0;
        for (int i = 0; i < f->n_free; i++) f->inverse[k][i] = column[i];
    }
}

/* Widens low[3], high[3] by all curves around f below the bound. Returns whether there is one. */
static inline bool classifier__held_widen(const classifier__held *f, double bound, double *low, double *high) {
    const double room = bound - f->squares;
    if (!(room >= 0.0)) return false;
    bool is_any = !f->is_known;
    /* a step: the points leave it open */
    for (int k = 0; k < 3 && !f->is_known; k++) low[k] = -HUGE_VAL, high[k] = HUGE_VAL;
    if (is_any) return true;
    for (int k = 0; k < f->n_free; k++) {
        for (int side = -1; side <= 1; side++) {
            const double way = side * sqrt(room / f->inverse[k][k]),
                         bypass = f->n_free > 2 ? f->p[2] + way * f->inverse[k][2] : 0.0;
            if (!(bypass >= 0.0 && bypass <= 1.0)) continue;
            const double p[3] = {f->p[0] + way * f->inverse[k][0], f->p[1] + way * f->inverse[k][1], bypass};
            for (int j = 0; j < 3; j++) {
                if (p[j] < low[j]) low[j] = p[j];
                if (p[j] > high[j]) high[j] = p[j];
            }
            is_any = true;
        }
    }
    return is_any;
}

typedef struct classifier__ranges {
    double low[3], high[3], bound, most_per_size; /* 1 / the smallest size: a hook there has no bypass left */
    bool is_without;                              /* a curve without a bypass is below the bound, and so is one
                                                     with any hook */
    classifier__held last;                        /* the curve that the next search starts from */
} classifier__ranges;

/* Widens the ranges by the curves with a hook of 1 / per_size. Returns whether there are any below the bound. */
static inline bool classifier__ranges_at(classifier__ranges *r, const classifier__held *best,
                                         const classifier__fit_data *d, double per_size) {
    bool is_in = r->is_without;
    if (!(per_size < r->most_per_size)) return is_in;
    for (int k = 0; k < 2; k++) { /* from the last one, and from the best of all */
        classifier__held f = k == 0 ? r->last : *best;
        f.per_size = per_size;
        classifier__held_fit(&f, d);
        if (k == 0 || f.squares < r->last.squares) r->last = f;
        if (!classifier__held_widen(&f, r->bound, r->low, r->high)) continue;
        is_in = true;
        break;
    }
    return is_in;
}

/* Finds the end of the accepted hooks between one that is accepted and one that is not. */
static inline double classifier__ranges_end(classifier__ranges *r, const classifier__held *best,
                                            const classifier__fit_data *d, double in, double out) {
    for (int k = 0; k < 8; k++) {
        const double middle = 0.5 * (in + out);
        if (classifier__ranges_at(r, best, d, middle)) in = middle;
        else out = middle;
    }
    return in;
}

/* Returns the next of the hooks that part the search: those at the sizes, and the best one. */
static inline double classifier__ranges_next(const classifier__fit_data *d, double best, double at) {
    double next = best > at ? best : HUGE_VAL;
    for (int i = 0; i < d->n; i++)
        if (1.0 / d->x[i] > at && 1.0 / d->x[i] < next) next = 1.0 / d->x[i];
    return next;
}

/* Sets the ranges of a fit. A sum of squares up to the bound is accepted. */
static inline void classifier__fit_ranges(const classifier__fit_try *f, const classifier__fit_data *d, bool bypass,
                                          bool hook, double bound, classifier_fit_result *result) {
    const classifier_curve *c = &result->curve;
    const bool is_alpha = c->law == CLASSIFIER_MOLERUS_HOFFMANN;
    classifier__held best;
    classifier__ranges r;
    memset(&best, 0, sizeof best);
    best.like = classifier_curve_of(c->law, 1.0, 1.0);
    best.p[0] = f->p[0], best.p[1] = is_alpha ? c->slope : f->p[1], best.p[2] = c->bypass;
    best.n_free = 3;
    r.bound = bound, r.last = best, r.most_per_size = 0.0;
    for (int i = 0; i < d->n; i++) r.most_per_size = 1.0 / d->x[i] > r.most_per_size ? 1.0 / d->x[i] : r.most_per_size;
    for (int k = 0; k < 3; k++) r.low[k] = r.high[k] = best.p[k];
    classifier__held without = best;
    without.n_free = 2;
    classifier__held_fit(&without, d);
    r.is_without = classifier__held_widen(&without, bound, r.low, r.high);
    bool is_in = bypass && classifier__ranges_at(&r, &best, d, 0.0);
    if (hook) { /* from none to ever smaller ones, four between each two sizes */
        double at = 0.0, before = 0.0, low = c->hook_size, high = is_in ? HUGE_VAL : 0.0;
        for (double next; (next = classifier__ranges_next(d, 1.0 / c->hook_size, at)) < HUGE_VAL;) {
            for (int k = 1; k <= 4; k++) {
                const double now = k < 4 ? at + 0.25 * k * (next - at) : next;
                const bool was_in = is_in;
                is_in = classifier__ranges_at(&r, &best, d, now);
                if (is_in && !(high > 0.0)) high = 1.0 / classifier__ranges_end(&r, &best, d, now, before);
                if (was_in && !is_in) low = 1.0 / classifier__ranges_end(&r, &best, d, before, now);
                before = now;
            }
            at = next;
        }
        if (is_in) low = 0.0;
        result->hook_low = low < c->hook_size ? low : c->hook_size; /* otherwise by rounding, where points lie on the
                                                                       curve */
        result->hook_high = high > c->hook_size ? high : c->hook_size;
    }
    result->size_low = riddle_exp(r.low[0]), result->size_high = riddle_exp(r.high[0]);
    result->slope_low = is_alpha ? (r.low[1] > 0.0 ? r.low[1] : 0.0) : riddle_exp(r.low[1]);
    result->slope_high = is_alpha ? r.high[1] : riddle_exp(r.high[1]);
    result->bypass_low = r.low[2] > 0.0 ? r.low[2] : 0.0, result->bypass_high = r.high[2] < 1.0 ? r.high[2] : 1.0;
    if (!bypass) result->bypass_low = result->bypass_high = 0.0;
    if (!hook) result->hook_low = result->hook_high = HUGE_VAL;
    if (!(result->size_sd < HUGE_VAL)) result->size_low = 0.0, result->size_high = HUGE_VAL;
    if (!(result->slope_sd < HUGE_VAL)) result->slope_low = 0.0, result->slope_high = HUGE_VAL;
}

CLASSIFIER_API classifier_status classifier_fit(classifier_curve_law law, unsigned free_parameters, const double *x,
                                                const double *t, const double *sd, int n,
                                                classifier_fit_result *result) {
    const classifier__fit_data d = {x, t, sd, n};
    const bool hook = (free_parameters & CLASSIFIER_FREE_HOOK) != 0,
               bypass = hook || (free_parameters & CLASSIFIER_FREE_BYPASS) != 0;
    const int wanted = 2 + (bypass ? 1 : 0) + (hook ? 1 : 0);
    classifier__fit_try best;
    double floor_t = 0.99;
    if (!result) return CLASSIFIER_BAD_ARGUMENT;
    memset(result, 0, sizeof *result);
    result->curve = classifier_curve_of(law, classifier__nan(), classifier__nan());
    result->curve.bypass = result->curve.hook_size = result->rms = result->student = result->dof = classifier__nan();
    result->size_sd = result->slope_sd = result->bypass_sd = result->hook_sd = classifier__nan();
    result->size_low = result->size_high = result->slope_low = result->slope_high = classifier__nan();
    result->bypass_low = result->bypass_high = result->hook_low = result->hook_high = classifier__nan();
    if (!classifier__fit_accepts(&d)) return CLASSIFIER_BAD_ARGUMENT;
    if (classifier__distinct(x, n, wanted + 1) <= wanted) return CLASSIFIER_TOO_FEW;
    memset(&best, 0, sizeof best);
    for (int i = 0; i < n; i++)
        if (t[i] < floor_t) floor_t = t[i];
    if (!(floor_t > 0.01)) floor_t = 0.01;
    if (classifier__fit_start(&best, law, &d, 0.0)) classifier__descend(&best, &d);
    else if (!bypass) return CLASSIFIER_OUTSIDE;
    if (bypass) classifier__fit_bypass(&best, &d, floor_t);
    if (!(best.squares < HUGE_VAL)) return CLASSIFIER_OUTSIDE;
    classifier__fit_steps(&best, &d, bypass);
    classifier__fit_from_grid(&best, &d, bypass);
    if (classifier__is_flat(&best, &d)) return CLASSIFIER_OUTSIDE;
    if (hook) classifier__fit_hook(&best, &d, floor_t);
    result->curve = classifier__curve_from(&best.like, best.p);
    const bool no_slope = law == CLASSIFIER_MOLERUS_HOFFMANN && result->curve.slope < 1e-7;
    if (no_slope) { /* the border: the others are judged without it */
        result->curve.slope = 0.0;
        best.n_free--;
        best.free[1] = 2, best.free[2] = 3;
    }
    result->at_border = (no_slope ? (unsigned)CLASSIFIER_SLOPE : 0u) |
                        (bypass && !(best.like.bypass > 0.0) ? (unsigned)CLASSIFIER_FREE_BYPASS : 0u) |
                        (hook && !(best.like.hook_size < HUGE_VAL) ? (unsigned)CLASSIFIER_FREE_HOOK : 0u);
    result->dof = n - best.n_free;
    result->student = sd ? 1.959963984540054 : riddle_student(0.95, n - best.n_free);
    classifier__fit_deviations(&best, &d, result);
    const double least = classifier__try_squares(&best, best.p, &d, NULL, NULL), free = n - wanted,
                 t95 = sd ? 1.959963984540054 : riddle_student(0.95, n - wanted);
    /* a hook bends to the noise at any size, which takes more of it than one parameter does: by 1/10,
       found by trials */
    classifier__fit_ranges(&best, &d, bypass, hook, least + (hook ? 1.1 : 1.0) * t95 * t95 * (sd ? 1.0 : least / free),
                           result);
    if (hook) result->student = classifier__nan();
    result->rms =
        sqrt(classifier__fit_squares(&best.like, best.p, best.free, best.n_free, x, t, NULL, n, NULL, NULL) / n);
    result->iterations = best.iterations;
    return CLASSIFIER_OK;
}

/* >>reconciliation ================================================================================================= */

/* For a split c the balance of a class misses r = f - c g - (1 - c) h, with variance s. With the variances ff, gg, hh
   of the three shares the least adjustment has the multiplier lambda = (r + c gg mu + (1 - c) hh nu) / s in each class,
   mu and nu such that coarse and fine (and so feed) still add up to 1. No share may fall below 0: one that would is
   held there, and the class is adjusted without it. */
typedef struct classifier__balance {
    const classifier_balance_data *data;
    double c, mu, nu;
} classifier__balance;
typedef struct classifier__adjusted {
    double f, g, h, lambda;
    double by_mu, by_nu, by_both; /* how far g falls with mu, h with nu, and each with the other multiplier */
} classifier__adjusted;

static inline classifier__adjusted classifier__adjust(const classifier__balance *b, int i) {
    const classifier_balance_data *d = b->data;
    const double c = b->c, e = 1.0 - c, ff = d->feed_sd[i] * d->feed_sd[i], gg = d->coarse_sd[i] * d->coarse_sd[i],
                 hh = d->fine_sd[i] * d->fine_sd[i];
    classifier__adjusted a = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    for (int hold = 0; hold < 4; hold++) { /* nothing, coarse, fine, both: just one of them is the least */
        const double G = hold & 1 ? 0.0 : d->coarse[i], H = hold & 2 ? 0.0 : d->fine[i], vg = hold & 1 ? 0.0 : gg,
                     vh = hold & 2 ? 0.0 : hh;
        const double s = ff + c * c * vg + e * e * vh;
        a.lambda = (d->feed[i] - c * G - e * H + c * vg * b->mu + e * vh * b->nu) / s;
        a.f = d->feed[i] - ff * a.lambda;
        a.g = G + vg * (c * a.lambda - b->mu);
        a.h = H + vh * (e * a.lambda - b->nu);
        a.by_mu = vg * (ff + e * e * vh) / s; /* vg - c^2 vg^2 / s */
        a.by_nu = vh * (ff + c * c * vg) / s;
        a.by_both = -c * e * vg * vh / s;
        const bool holds_rightly = (!(hold & 1) || d->coarse[i] + gg * (c * a.lambda - b->mu) <= 0.0) &&
                                   (!(hold & 2) || d->fine[i] + hh * (e * a.lambda - b->nu) <= 0.0);
        if (a.g >= 0.0 && a.h >= 0.0 && holds_rightly) break;
    }
    return a;
}

/* Sums what the adjustment adds to coarse and fine, and how these sums decrease with mu and nu. */
static inline void classifier__surplus(const classifier__balance *b, double sum[2], double fall[3]) {
    sum[0] = sum[1] = fall[0] = fall[1] = fall[2] = 0.0;
    for (int i = 0; i < b->data->classes; i++) {
        const classifier__adjusted a = classifier__adjust(b, i);
        sum[0] += a.g - b->data->coarse[i], sum[1] += a.h - b->data->fine[i];
        fall[0] += a.by_mu, fall[1] += a.by_nu, fall[2] += a.by_both;
    }
}

/* Solves mu, nu for the split c; returns chi squared. Newton's method; one step suffices where no share is held. */
static inline double classifier__balance_at(classifier__balance *b, double c) {
    const classifier_balance_data *d = b->data;
    double sum[2], fall[3], chi = 0.0;
    b->c = c, b->mu = b->nu = 0.0;
    classifier__surplus(b, sum, fall);
    for (int round = 0; round < 100 && fabs(sum[0]) + fabs(sum[1]) > 1e-16 * d->classes; round++) {
        const classifier__balance from = *b;
        const double det = fall[0] * fall[1] - fall[2] * fall[2];
        double way[2] = {sum[0], sum[1]}, left = HUGE_VAL;
        if (det > 0.0) {
            way[0] = (sum[0] * fall[1] - sum[1] * fall[2]) / det;
            way[1] = (sum[1] * fall[0] - sum[0] * fall[2]) / det;
        }
        const double was = way[0] * sum[0] + way[1] * sum[1];
        for (double share = 1.0; share > 1e-6; share *= 0.5) {
            b->mu = from.mu + share * way[0], b->nu = from.nu + share * way[1];
            classifier__surplus(b, sum, fall);
            left = fabs(way[0] * sum[0] + way[1] * sum[1]);
            if (left <= 0.9 * fabs(was)) break;
        }
        if (!(left <= 0.9 * fabs(was))) break; /* rounding */
    }
    for (int i = 0; i < d->classes; i++) {
        const classifier__adjusted a = classifier__adjust(b, i);
        const double df = (a.f - d->feed[i]) / d->feed_sd[i], dg = (a.g - d->coarse[i]) / d->coarse_sd[i],
                     dh = (a.h - d->fine[i]) / d->fine_sd[i];
        chi += df * df + dg * dg + dh * dh;
    }
    if (d->coarse_share_sd > 0.0)
        chi += (c - d->coarse_share) * (c - d->coarse_share) / (d->coarse_share_sd * d->coarse_share_sd);
    return chi;
}

/* Returns half of d(chi squared)/dc by the envelope theorem: minus the sum of multiplier * (reconciled
   coarse - reconciled fine) */
static inline double classifier__balance_slope(double c, const void *user) {
    classifier__balance b = *(const classifier__balance *)user;
    const classifier_balance_data *d = b.data;
    double slope = d->coarse_share_sd > 0.0 ? (c - d->coarse_share) / (d->coarse_share_sd * d->coarse_share_sd) : 0.0;
    (void)classifier__balance_at(&b, c);
    for (int i = 0; i < d->classes; i++) {
        const classifier__adjusted a = classifier__adjust(&b, i);
        slope -= a.lambda * (a.g - a.h);
    }
    return slope;
}

static inline classifier_status classifier__reconcile(const classifier_balance_data *data, double *t, double *t_sd,
                                                      double *feed, double *coarse, double *fine,
                                                      classifier_balance_result *result) {
    if (!(data && result && data->feed && data->coarse && data->fine && data->feed_sd && data->coarse_sd &&
          data->fine_sd))
        return CLASSIFIER_BAD_ARGUMENT;
    if (data->classes < 2) return CLASSIFIER_EMPTY;
    bool known = data->coarse_share == data->coarse_share;
    if (known && !(data->coarse_share > 0.0 && data->coarse_share < 1.0 && classifier__positive(data->coarse_share_sd)))
        return CLASSIFIER_BAD_ARGUMENT;
    double total[3] = {0.0, 0.0, 0.0}, differ = 0.0;
    for (int i = 0; i < data->classes; i++) {
        const double v[3] = {data->feed[i], data->coarse[i], data->fine[i]},
                     s[3] = {data->feed_sd[i], data->coarse_sd[i], data->fine_sd[i]};
        for (int k = 0; k < 3; k++) {
            if (!(v[k] >= 0.0 && v[k] < HUGE_VAL && classifier__positive(s[k]))) return CLASSIFIER_BAD_ARGUMENT;
            total[k] += v[k];
        }
        differ += fabs(v[1] - v[2]);
    }
    for (int k = 0; k < 3; k++) {
        if (!(total[k] > 0.0)) return CLASSIFIER_EMPTY;
        if (!(fabs(total[k] - 1.0) <= 1e-3)) return CLASSIFIER_NOT_NORMALISED;
    }
    if (!known && !(differ > 1e-9)) return CLASSIFIER_OUTSIDE; /* equal products: the split cannot be determined */
    classifier_balance_data d = *data;
    if (!known) d.coarse_share_sd = classifier__nan();
    classifier__balance b;
    b.data = &d;
    /* a scan for the valley of chi squared, then the zero of its slope */
    double best = 0.5, best_chi = HUGE_VAL, stride = 1.0 / 256.0;
    for (int i = 1; i < 256; i++) {
        double chi = classifier__balance_at(&b, i * stride);
        if (chi < best_chi) {
            best_chi = chi;
            best = i * stride;
        }
    }
    double low = best > stride ? best - stride : 1e-9, high = best < 1.0 - stride ? best + stride : 1.0 - 1e-9;
    double low_slope = classifier__balance_slope(low, &b), high_slope = classifier__balance_slope(high, &b);
    if (!(low_slope < 0.0 && high_slope > 0.0)) return CLASSIFIER_OUTSIDE;
    best = classifier__brent(classifier__balance_slope, &b, low, low_slope, high, high_slope);
    double chi = classifier__balance_at(&b, best), h = 1e-3 * (best < 0.5 ? best : 1.0 - best), c = best, e = 1.0 - c;
    double curvature = (classifier__balance_slope(best + h, &b) - classifier__balance_slope(best - h, &b)) / (2.0 * h);
    if (!(curvature > 0.0)) return CLASSIFIER_OUTSIDE;
    double c_variance = 1.0 / curvature;
    for (int i = 0; i < d.classes; i++) {
        double ff = d.feed_sd[i] * d.feed_sd[i], gg = d.coarse_sd[i] * d.coarse_sd[i], hh = d.fine_sd[i] * d.fine_sd[i],
               s = ff + c * c * gg + e * e * hh;
        const classifier__adjusted a = classifier__adjust(&b, i);
        const double g = a.g, f = c * g + e * a.h; /* = a.f but for rounding, so that T is a share */
        if (feed) feed[i] = f;
        if (coarse) coarse[i] = g;
        if (fine) fine[i] = a.h;
        double value = f > 0.0 ? c * g / f : classifier__nan();
        if (t) t[i] = value;
        if (!t_sd) continue;
        /* T = c g / f: covariance of the adjusted f and g at fixed c, and how both move with c; of a share that is held
           at 0, as if it were not, for its measurement is no better than the others */
        double vff = ff - ff * ff / s, vgg = gg - c * c * gg * gg / s, vfg = c * ff * gg / s, jf = -value / f,
               jg = c / f, turn = d.coarse[i] - d.fine[i];
        double dc = g / f + jf * ff * turn / s - jg * c * gg * turn / s;
        t_sd[i] = sqrt(jf * jf * vff + jg * jg * vgg + 2.0 * jf * jg * vfg + dc * dc * c_variance);
    }
    result->coarse_share = c;
    result->coarse_share_sd = sqrt(c_variance);
    result->chi_squared = chi;
    result->freedom = d.classes - 1 - (known ? 0 : 1);
    return CLASSIFIER_OK;
}

CLASSIFIER_API classifier_status classifier_reconcile(const classifier_balance_data *data, double *t, double *t_sd,
                                                      double *feed, double *coarse, double *fine,
                                                      classifier_balance_result *result) {
    if (result) {
        result->coarse_share = result->coarse_share_sd = result->chi_squared = classifier__nan();
        result->freedom = 0;
    }
    classifier_status status = classifier__reconcile(data, t, t_sd, feed, coarse, fine, result);
    double *const outputs[5] = {t, t_sd, feed, coarse, fine};
    for (int k = 0; k < 5; k++) classifier__leave(status, data ? data->classes : 0, outputs[k]);
    return status;
}

/* >>circuits ======================================================================================================= */

static inline classifier_status classifier__circuit(const classifier_circuit_def *circuit, const double *t,
                                                    double *coarse, double *load) {
    double to[CLASSIFIER_STAGES][CLASSIFIER_STAGES], out[CLASSIFIER_STAGES], leaves[CLASSIFIER_STAGES],
        flow[CLASSIFIER_STAGES];
    if (!(circuit && t && coarse) || circuit->stages < 1 || circuit->stages > CLASSIFIER_STAGES)
        return CLASSIFIER_BAD_ARGUMENT;
    int n = circuit->stages;
    for (int i = 0; i < n; i++) {
        int to_c = circuit->coarse_to[i], to_f = circuit->fine_to[i];
        if (!(t[i] >= 0.0 && t[i] <= 1.0) || to_c < CLASSIFIER_TO_FINE || to_c >= n || to_f < CLASSIFIER_TO_FINE ||
            to_f >= n)
            return CLASSIFIER_BAD_ARGUMENT;
        out[i] = 0.0;
        for (int j = 0; j < n; j++) to[i][j] = 0.0;
        *(to_c >= 0 ? &to[i][to_c] : &out[i]) += t[i];
        *(to_f >= 0 ? &to[i][to_f] : &out[i]) += 1.0 - t[i];
    }
    /* Stages are eliminated from the last one down: what enters a stage continues to others in the shares in which it
       leaves. Only positive numbers are summed (Grassmann, Taksar and Heyman 1985), so a flow that leaves slowly
       keeps its digits. */
    for (int k = n - 1; k >= 0; k--) {
        leaves[k] = out[k];
        for (int j = 0; j < k; j++) leaves[k] += to[k][j];
        for (int i = 0; i < k && leaves[k] > 0.0; i++) {
            double share = to[i][k] / leaves[k];
            for (int j = 0; j < k; j++) to[i][j] += share * to[k][j];
            out[i] += share * out[k];
        }
    }
    for (int k = 0; k < n; k++) {
        double enters = k == 0 ? 1.0 : 0.0;
        for (int i = 0; i < k; i++) enters += flow[i] * to[i][k];
        flow[k] = enters > 0.0 ? enters / leaves[k] : 0.0;
        if (!(flow[k] < HUGE_VAL)) return CLASSIFIER_NO_OUTLET;
    }
    *coarse = 0.0;
    for (int i = 0; i < n; i++) {
        if (circuit->coarse_to[i] == CLASSIFIER_TO_COARSE) *coarse += t[i] * flow[i];
        if (circuit->fine_to[i] == CLASSIFIER_TO_COARSE) *coarse += (1.0 - t[i]) * flow[i];
        if (load) load[i] = flow[i];
    }
    return CLASSIFIER_OK;
}

CLASSIFIER_API classifier_status classifier_circuit(const classifier_circuit_def *circuit, const double *t,
                                                    double *coarse, double *load) {
    classifier_status status = classifier__circuit(circuit, t, coarse, load);
    classifier__leave(status, circuit && circuit->stages <= CLASSIFIER_STAGES ? circuit->stages : 0, load);
    return classifier__leave(status, 1, coarse);
}

#endif /* CLASSIFIER__BODIES */

#ifdef __cplusplus
}
#endif
#endif /* CLASSIFIER_H */
