/* granulation.h: wet granulation in a high-shear mixer: coalescence laws, a discrete simulation, population balances.

   #include <stdio.h>
   #include "granulation.h"
   int main(void) {
       granulation_def def = granulation_default_def();
       granulation_sim sim;
       if (granulation_sim_init(&sim, &def)) return 1;
       granulation_granule nucleus = {0.52e-12, 0.33e-12, 0.15e-12};           // solid, liquid, air [m3]
       granulation_sim_add(&sim, &nucleus, 200);
       granulation_status status = granulation_sim_run(&sim, 100);             // 100 steps
       printf("%d granules, d43 %g m\n", sim.n, granulation_sim_mean(&sim, 4, 3));
       granulation_sim_free(&sim);
       return status;
   }

   Models. State of a granule, film, consolidation, breakage, critical size: Gantt and Gatzke (discrete element
   granulation, "the paper", equations (1) to (41)); coalescence: Liu, Tapia and Litster (2000), Liu and Litster (2002);
   viscous Stokes number: Ennis (1991); strength: Rumpf (1962), Hertz; rebound of a yielding sphere: Johnson (1985);
   saturation kernel: Pouw et al. (2002); population balance: fixed pivot, Kumar and Ramkrishna (1996), cell average,
   Kumar et al. (2006); constant-number Monte Carlo: Smith and Matsoukas (1998). The paper mixes two conventions of
   reduced mass and diameter and has misprints: GRANULATION_CONSISTENT is the corrected set, GRANULATION_PRINTED the
   printed prefactors. docs/granulation.md lists every difference.

   Find your way: >>laws (pure functions), >>simulation, >>balance (population balance), >>montecarlo; bodies have the
   same tags.

   Units: SI. Angles [rad]. Fractions and numbers without unit [-].

   Memory: through def.memory; nothing is allocated in a step unless the number of granules or of contacts grows. A call
   that runs out of memory returns GRANULATION_NO_MEMORY; the object can be used on and must be freed as ever.

   Threads: no object is shared; use one a thread. There is no thread inside.

   Determinism: same def, same calls, same bits on every machine and compiler (without fused multiply-add:
   -ffp-contract=off).

   Validity: the material's constants are a fit. granulation_sim_outside() tells what lies outside its data.

   Which order: a step consolidates, breaks, stirs, moves and collides. Indices of granules hold until the next step.

   What it does not do: no contact forces and no rotation (collisions are instantaneous), no attrition, no layering, no
   drying, no flow field: velocities come from distributions. A granule is a sphere with a mean composition; its film
   has one thickness.

   Shared copy instead of static inline: #define GRANULATION_API extern everywhere and GRANULATION_IMPLEMENTATION
   in one file. */
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "granulation.h needs NaN and signed zero: compile without -ffast-math"
#endif
#ifndef RIDDLE_GRANULATION_H
#define RIDDLE_GRANULATION_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifndef GRANULATION_API
#define GRANULATION_API static inline
#define GRANULATION__BODIES
#elif defined(GRANULATION_IMPLEMENTATION)
#define GRANULATION__BODIES
#endif
#ifdef __cplusplus
extern "C" {
#endif

/* ---- status ---- */
/* clang-format off */
#define GRANULATION_STATUSES(X)                                                                       \
    X(GRANULATION_OK, "ok")                                                                           \
    X(GRANULATION_BAD_ARGUMENT, "an argument is outside its range")                                   \
    X(GRANULATION_BAD_DEF, "a field of the definition is outside its range")                          \
    X(GRANULATION_NO_MEMORY, "out of memory")                                                         \
    X(GRANULATION_NO_ROOM, "no place without overlap was found for a granule")                        \
    X(GRANULATION_TOO_LARGE, "a granule has outgrown half the box")                                   \
    X(GRANULATION_POPULATION, "breakage reached the largest number of granules allowed")              \
    X(GRANULATION_EVENTS, "too many collisions in one step")                                          \
    X(GRANULATION_GEL, "the population has gelled: volume is lost above the last pivot")              \
    X(GRANULATION_STEP, "the time step became too small, or too many steps were needed")              \
    X(GRANULATION_KERNEL, "a kernel or a rate is negative, infinite or not a number")
#define GRANULATION__ENUM(name, text) name,
typedef enum granulation_status { GRANULATION_STATUSES(GRANULATION__ENUM) GRANULATION_STATUS_COUNT } granulation_status;

/* Reasons for the outcome of a collision. */
#define GRANULATION_REASONS(X)                                                                        \
    X(GRANULATION_NONE, "the granules do not approach each other")                                    \
    X(GRANULATION_TYPE_I, "Type I: the film stopped them before the surfaces met (11)")               \
    X(GRANULATION_TYPE_II_PLASTIC, "Type II: held by the film after permanent deformation (21)")      \
    X(GRANULATION_TYPE_II_ELASTIC, "Type II: held by the film after an elastic contact (23)")         \
    X(GRANULATION_TYPE_II_DRY, "Type II: held by binder pressed out of dry surfaces (25)")            \
    X(GRANULATION_REBOUND_PLASTIC, "rebound: the film could not hold a deforming contact")            \
    X(GRANULATION_REBOUND_ELASTIC, "rebound: elastic contact")                                        \
    X(GRANULATION_REBOUND_DRY, "rebound: dry surfaces, too little binder pressed out")                \
    X(GRANULATION_REBOUND_SIZE, "rebound: the granule would exceed the critical size (39)")
typedef enum granulation_reason { GRANULATION_REASONS(GRANULATION__ENUM) GRANULATION_REASON_COUNT } granulation_reason;
/* clang-format on */

GRANULATION_API const char *granulation_status_text(granulation_status status); /* never NULL; static storage */
GRANULATION_API const char *granulation_reason_text(granulation_reason reason); /* never NULL; static storage */

/* Memory hook: old NULL allocates, new_size 0 frees and returns NULL, else grows. fn NULL: malloc, realloc, free. */
typedef struct granulation_memory {
    void *(*fn)(void *user, void *old, size_t old_size, size_t new_size);
    void *user;
} granulation_memory;

/* ==== >>laws: the state of a granule ==== */

/* Volumes of one granule (1). */
typedef struct granulation_granule {
    double s; /* solid [m3], > 0 */
    double l; /* liquid binder [m3], >= 0 */
    double a; /* air [m3], >= 0 */
} granulation_granule;

static inline double granulation_volume(const granulation_granule *g);          /* (2) V = s + l + a [m3] */
/* D = (6 V / pi)^(1/3) [m]; volume >= 0 [m3]. */
static inline double granulation_diameter(double volume);
/* volume of a sphere [m3]; diameter >= 0 [m] */
static inline double granulation_sphere(double diameter);
static inline double granulation_porosity(const granulation_granule *g);        /* (3) (l + a) / V [-], 0 .. 1 */
/* (3) l / (l + a) [-]; 1 without pores */
static inline double granulation_saturation(const granulation_granule *g);
static inline double granulation_liquid_fraction(const granulation_granule *g); /* (3) l / V [-] */
/* (3) l / s, by volume as printed [-] */
static inline double granulation_moisture(const granulation_granule *g);
/* porosity with all air gone, l / (s + l) [-] */
static inline double granulation_least_porosity(const granulation_granule *g);
/* Returns the mass (4) [kg]; densities of solid, liquid and air [kg/m3] */
static inline double granulation_mass(const granulation_granule *g, double solid, double liquid, double air);
/* Returns the thickness of the binder film (5) [m], 0 for a dry surface; critical saturation 0 < s_crit <= 1. Written
   as (l (1 - s_crit) - s_crit a) / (pi D^2), which is D (L - eps s_crit) / 6 without its cancellation. */
static inline double granulation_film(const granulation_granule *g, double s_crit);
/* negative before the film appears */
static inline double granulation_film_unclipped(const granulation_granule *g, double s_crit);
/* (34) height of asperities A Dp [m]; both > 0 */
static inline double granulation_asperity(double factor, double grain_diameter);

/* ==== consolidation (26), (27) ==== */
/* Returns the rate of (27), da/dt [m3/s]; rate constant [1/s]. */
static inline double granulation_consolidation_rate(const granulation_granule *g, double rate_constant);
/* Returns the air volume after a time, exact: the air fraction a / V decays as exp(-k t). kt = k t >= 0 [-]. [m3] */
static inline double granulation_consolidate(const granulation_granule *g, double kt);
/* Returns k t until the film appears [-]; 0 if it is there; infinite without liquid, or with s_crit 1 */
static inline double granulation_film_time(const granulation_granule *g, double s_crit);

/* ==== strength (13) to (17) ==== */
/* Returns the largest contact pressure (13) [Pa] by Hertz, of a force [N], effective modulus [Pa], reduced
   diameter [m]. */
static inline double granulation_hertz_pressure(double force, double modulus, double diameter);
/* Returns the effective modulus (14) [Pa], mended: 1 / E* = (1 - nu1^2) / E1 + (1 - nu2^2) / E2; moduli > 0, Poisson
   ratios -1 .. 0.5. */
static inline double granulation_effective_modulus(double e1, double nu1, double e2, double nu2);
/* Returns (14) as printed: the same sum, which is a compliance [1/Pa]. */
static inline double granulation_contact_compliance(double e1, double nu1, double e2, double nu2);
/* (15) tensile stress at the contact's edge [Pa] */
static inline double granulation_edge_tension(double pressure, double poisson);
/* Returns the static tensile strength (16) [Pa] by Rumpf; 0 < porosity < 1, saturation 0 .. 1, shape factor (6 for
   spheres), surface tension [N/m], contact angle [rad], grain diameter [m]. */
static inline double granulation_rumpf_strength(double porosity, double saturation, double shape, double tension,
                                                double angle, double grain);
/* (17) 2 sigma / (3 - 6 nu) [Pa]; nu < 0.5 */
static inline double granulation_yield_stress(double strength, double poisson);

/* ==== a collision: Liu, Tapia and Litster ==== */
/* Prefactors. CONSISTENT: those that belong to the reduced m, D of (9), (10), with the total approach of the centres.
   PRINTED: those of the paper's (8), (20), (40), which belong to harmonic means of twice the size. u0 and viscosity,
   missing in (18) and (20), are restored in both. */
typedef enum granulation_convention { GRANULATION_CONSISTENT, GRANULATION_PRINTED } granulation_convention;
#define GRANULATION_JOHNSON 2.46              /* of (18) as printed; Johnson's restitution exactly: 2.427218 */
#define GRANULATION_RECOVERY 7.36423562897306 /* (9 pi / 4) (3 pi / 8)^(1/4): the 7.36 of (24) */
#define GRANULATION_FIRST_YIELD 1.65625       /* first yield at St_def / (Y/E*)^4 = 53/32 */

/* Returns the reduced mass or diameter (9), (10): a b / (a + b); b infinite (a wall, the impeller) gives
   a. Both > 0. */
static inline double granulation_reduced(double a, double b);
/* Returns the viscous Stokes number (8) [-]: reduced mass [kg], u0 = half the relative speed [m/s], viscosity > 0 [Pa
   s], reduced diameter [m]. */
static inline double granulation_viscous_stokes(granulation_convention c, double m, double u0, double viscosity,
                                                double d);
/* Returns the Stokes deformation number (22) [-]; yield stress > 0 [Pa]. */
static inline double granulation_deformation_stokes(double m, double u0, double d, double yield);
/* Returns ln(h0 / ha), and 0 for a film no thicker than the asperities: a film never accelerates.
   h0 >= 0, ha > 0 [m]. */
static inline double granulation_film_logarithm(double h0, double ha);
/* Returns half the relative speed (7) [m/s] when the asperities meet, may be negative; log_film from
   granulation_film_logarithm */
static inline double granulation_approach_speed(double u0, double st_v, double log_film);
static inline bool granulation_is_type_one(double st_v, double log_film); /* (11); false without a film */
/* Returns the largest contact area (12) [m2] at u1 >= 0 [m/s]; reduced mass, diameter; yield stress. */
static inline double granulation_contact_area(double u1, double m, double d, double yield);
/* Returns the permanent deformation (19) [m] of a contact area; negative: the contact stayed elastic.
   yield_ratio = Y / E* >= 0 [-]. */
static inline double granulation_deformation(double area, double d, double yield_ratio);
/* Returns the same over d (19), (24), of St_def and B = u1 / u0 >= 0 [-]. */
static inline double granulation_relative_deformation(double st_def, double b, double yield_ratio);
/* Returns half the relative speed (18) [m/s] when the surfaces part, never above u1 = B u0. */
static inline double granulation_rebound_speed(double u0, double b, double yield_ratio, double st_def);
/* Returns half the relative speed (20) [m/s] when the bridge would break; not above 0: it holds. deformation >= 0 [m],
   h0 >= ha [m], or equal to the deformation for dry granules. Only the sign has a meaning below -u0. */
static inline double granulation_separation_speed(granulation_convention c, double u2, double u0, double st_v,
                                                  double deformation, double h0, double ha);
/* Returns the same (25), made consistent, for dry surfaces, whose film is the deformation. */
static inline double granulation_dry_separation_speed(granulation_convention c, double u2, double u0, double st_v,
                                                      double deformation, double ha);
static inline bool granulation_is_elastic_type_two(double st_v, double log_film); /* (23) St_v < 2 ln(h0 / ha) */
/* Return both sides of (21) as printed; left < right: Type II. It reports Type II also for a negative deformation (its
   square hides the sign), so nothing here decides by it. b = u1 / u0 > 0 [-]; d, deformation (not 0), h0 >= ha [m]. */
static inline double granulation_printed_left(double yield_ratio, double st_def);
static inline double granulation_printed_right(double st_v, double st_def, double yield_ratio, double b, double d,
                                               double deformation, double h0, double ha);

/* ==== critical size (39) to (41), velocities (33), breakage (28) to (36) ==== */
/* Returns the force of the film (40) [N] at u [m/s] (half the relative speed) and gap 2h [m]. */
static inline double granulation_film_force(granulation_convention c, double d, double viscosity, double u, double gap);
static inline double granulation_bond_area(double d, double deformation); /* (41) pi D delta [m2] */
/* Returns the critical diameter (39) [m], A1 (K^(3/2) sigma)^a1; K = area / force [1/Pa] >= 0, strength sigma [Pa]; A1
   in [m Pa^(a1/2)]. */
static inline double granulation_critical_diameter(double a1_factor, double exponent, double k, double strength);
/* Returns the tip speed (33) [m/s] of an impeller, turns [1/s], diameter [m]: pi n D. The paper's 120 rpm -> 1 m/s is n
   D / 2: PRINTED. */
static inline double granulation_tip_speed(granulation_convention c, double turns, double diameter);
/* Returns (22), (28) for one granule, its own m and D: pi rho u^2 / (12 Y) [-], independent of size; density [kg/m3],
   speed [m/s]. */
static inline double granulation_breakage_stokes(double density, double speed, double yield);
/* Returns the Herschel-Bulkley stress (30), Y + k gamma^n [Pa]; consistency [Pa s^n], shear rate [1/s], index
   n [-]; all >= 0. */
static inline double granulation_herschel_bulkley(double yield, double consistency, double shear_rate, double index);
/* Returns the strain (31) of Kenningley, of the Kozeny-Carman equation [-]; d32: Sauter mean of the
   constituent grains [m]. */
static inline double granulation_kozeny_strain(double porosity, double density, double speed, double d32,
                                               double viscosity);
/* (36) */
static inline granulation_granule granulation_half(const granulation_granule *g);
/* (38) */
static inline granulation_granule granulation_sum(const granulation_granule *a, const granulation_granule *b);
/* Returns the viscosity by Arrhenius [Pa s]: mu0 exp(E/R (1/T - 1/T0)); mu0 > 0, activation E/R >= 0 [K],
   temperatures > 0 [K]. */
static inline double granulation_arrhenius(double viscosity, double activation, double temperature, double reference);

/* ==== the outcome of a collision as one pure function ==== */

/* How the yield stress of a pair follows from those of its two granules. */
typedef enum granulation_pair_yield { GRANULATION_YIELD_MEAN, GRANULATION_YIELD_WEAKER } granulation_pair_yield;
/* Y / E* fixed (yield_ratio), or E* fixed (modulus). */
typedef enum granulation_stiffness { GRANULATION_FIXED_RATIO, GRANULATION_FIXED_MODULUS } granulation_stiffness;
/* The critical diameter: none; limit_diameter (w / limit_moisture)^(1/4); (39) to (41) with A1 = limit_diameter
   as it stands. */
typedef enum granulation_limit {
    GRANULATION_NO_LIMIT,
    GRANULATION_LIMIT_MOISTURE,
    GRANULATION_LIMIT_PRINTED
} granulation_limit;

/* Material and rules of a collision. Defaults: the documented set G1 of docs/granulation.md. */
typedef struct granulation_laws {
    granulation_convention convention; /* default CONSISTENT */
    double viscosity;                  /* binder [Pa s], > 0; 0.035 (fitted to the paper's tables) */
    double solid_density;              /* [kg/m3], > 0; 1700 */
    double liquid_density;             /* [kg/m3], >= 0; 1000 */
    double air_density;                /* [kg/m3], >= 0; 1.2 */
    double surface_tension;            /* [N/m], >= 0; 0.048 */
    double contact_angle;              /* [rad], 0 .. pi/2; 0 */
    double grain_diameter;             /* of the constituent powder [m], > 0; 1e-6 */
    double shape_factor;               /* C of (16) [-], > 0; 6 */
    double asperity_factor;            /* A of (34) [-], > 0; 0.1 */
    double poisson;                    /* [-], -1 .. below 0.5; 0.3 */
    double critical_saturation;        /* S* [-], above 0 .. 1; 0.85 */
    granulation_stiffness stiffness;   /* default FIXED_RATIO */
    double yield_ratio;                /* Y / E* [-], >= 0; 0.04 (fitted) */
    double modulus;                    /* E* [Pa], > 0; 1e7; used with FIXED_MODULUS */
    granulation_pair_yield pair_yield; /* default MEAN */
    bool elastic_rule;                 /* an elastic contact (deformation <= 0) may be held by (23); false: it rebounds;
                                          default false */
    bool dry_rule;                     /* dry surfaces may be held by (25); false: they rebound; default false */
    bool deep_film;                    /* separation from a film max(h0, deformation): with dry_rule no jump at h0 = ha;
                                          default false */
    granulation_limit limit;           /* default LIMIT_MOISTURE */
    double limit_diameter;             /* [m] with LIMIT_MOISTURE, A1 [m Pa^(a1/2)] with
                                          LIMIT_PRINTED, > 0; 2.30e-4 (fitted) */
    double limit_moisture;   /* moisture l / s of limit_diameter [-], > 0; 33/52; with LIMIT_PRINTED: A1
                                (w / limit_moisture)^(1/4) */
    double limit_exponent;   /* a1 of (39) [-], > 0; 0.5; used with LIMIT_PRINTED */
    bool limit_type_one;     /* the limit also holds for Type I; default false */
    double breakage_stokes;  /* St_def* of (28) [-], > 0; 0.2; HUGE_VAL: nothing breaks */
    double flow_consistency; /* (30) [Pa s^n], >= 0; 0 */
    double flow_index;       /* (30) [-], >= 0; 1 */
    double shear_rate;       /* (30) [1/s], >= 0; 0 */
} granulation_laws;

/* Properties of a granule for the laws; computed once by granulation_body_of. For a wall or the impeller:
   granulation_wall. */
typedef struct granulation_body {
    granulation_granule volumes;
    double diameter; /* [m]; infinite for a wall */
    double mass;     /* [kg]; infinite for a wall */
    double film;     /* h0 [m] */
    double strength; /* Rumpf [Pa] */
    double yield;    /* [Pa]; infinite for a wall */
} granulation_body;

/* The result of a collision. Velocities are half the relative ones, as in the paper. */
typedef struct granulation_collision {
    granulation_reason reason;
    bool coalesces;
    bool both;       /* Type I, and (21) as printed would hold a contact at full speed (B = 1) too: the "both" of the
                        paper's figure 10 */
    double st_v;     /* [-] */
    double st_def;   /* [-] */
    double log_film; /* ln(h0 / ha) [-], 0 for dry surfaces */
    double u0, u1;   /* approach, at contact [m/s] */
    double u2, u3;   /* at the end of contact, when the film ends [m/s]; 0 after Type I */
    double deformation; /* permanent [m]; negative: elastic; 0 after Type I */
    double limit;       /* critical diameter [m]; infinite: none */
} granulation_collision;

GRANULATION_API granulation_laws granulation_default_laws(void);
/* Returns GRANULATION_BAD_DEF and the name of the first bad field (field may be NULL), otherwise ok and NULL;
   BAD_ARGUMENT and "laws" for NULL. The other check functions do the same ("def"). */
GRANULATION_API granulation_status granulation_check_laws(const granulation_laws *laws, const char **field);
/* Computes the properties of a granule; every derived one is NaN if the volumes are outside their ranges. */
static inline granulation_body granulation_body_of(const granulation_laws *laws, const granulation_granule *g);
/* Returns a wall with a film [m] of its own: infinitely heavy, flat and strong. */
static inline granulation_body granulation_wall(double film);
/* Returns the outcome of a collision. speed: full relative speed |v1 - v2| [m/s]; not above 0: GRANULATION_NONE. The
   laws must be checked. If a number is NaN the reason is GRANULATION_NONE. */
static inline granulation_collision granulation_collide(const granulation_laws *laws, const granulation_body *i,
                                                        const granulation_body *j, double speed);

/* Returns the reason from dimensionless numbers: the axes of a coalescence boundary map. Reason only; the size limit is
   left out. st_v, st_def > 0; yield_ratio = Y/E* >= 0; film_ratio = h0 / ha >= 0 (not above 1: dry); width = D / ha > 0
   with the reduced D. */
static inline granulation_reason granulation_classify(const granulation_laws *laws, double st_v, double st_def,
                                                      double yield_ratio, double film_ratio, double width);
/* Returns whether a granule breaks (28) at this speed [m/s]. */
static inline bool granulation_breaks(const granulation_laws *laws, const granulation_body *body, double speed);

/* ==== random numbers: xoshiro256** (Blackman and Vigna 2018), seeded by splitmix64 ==== */
typedef struct granulation_random {
    uint64_t state[4];
} granulation_random;

static inline granulation_random granulation_random_seed(uint64_t seed);
static inline uint64_t granulation_random_bits(granulation_random *r);
static inline double granulation_random_uniform(granulation_random *r); /* 0 <= u < 1 */
static inline double granulation_random_normal(granulation_random *r);  /* mean 0, deviation 1 */

/* ==== >>simulation: granules in a periodic box ==== */

/* Distance of centres at which two granules meet: the sum of the radii, or (readings of the paper's "the radius of one
   particle encounters another") the larger or the smaller of them. */
typedef enum granulation_contact {
    GRANULATION_CONTACT_SUM,
    GRANULATION_CONTACT_LARGER,
    GRANULATION_CONTACT_SMALLER
} granulation_contact;
/* SWEPT: every contact within a step, in the order of time. END_OF_STEP: the paper's rule, pairs that overlap after a
   step, by index, one event a granule and step. */
typedef enum granulation_detection { GRANULATION_SWEPT, GRANULATION_END_OF_STEP } granulation_detection;
/* CONSERVING: impulse along the line of centres with a coefficient of restitution. REVERSAL: the paper's v -> -v of
   both; swept, it may leave overlaps where granules lock. */
typedef enum granulation_bounce { GRANULATION_CONSERVING, GRANULATION_REVERSAL } granulation_bounce;

/* Signs of the mean velocity of a granule: as given; + or - by chance in each component; + or - for all three at once,
   two opposed streams (which is what REVERSAL makes of one). */
typedef enum granulation_signs {
    GRANULATION_SAME_SIGNS,
    GRANULATION_RANDOM_SIGNS,
    GRANULATION_TWO_STREAMS
} granulation_signs;

typedef struct granulation_event {
    double time;                   /* [s] of the simulation */
    int i, j;                      /* indices; after coalescence i is the new granule */
    double speed;                  /* relative [m/s] */
    double diameter_i, diameter_j; /* before [m] */
    granulation_collision collision;
} granulation_event;

typedef struct granulation_def {
    granulation_laws laws;
    double box;                      /* edge [m], > 0; 2e-3 */
    double step;                     /* [s], > 0; 1 */
    double dilation;                 /* path of a step = velocity step / dilation [-], > 0; 1e4: 1 s of process is 0.1
                                        ms of flight */
    double velocity_mean[3];         /* of new granules [m/s]; 3, 3, 3 */
    double velocity_deviation[3];    /* [m/s], >= 0; 1, 1, 1 */
    granulation_signs signs;         /* default SAME_SIGNS */
    granulation_detection detection; /* default SWEPT */
    granulation_contact contact;     /* default SUM */
    granulation_bounce bounce;       /* default CONSERVING */
    double restitution;              /* [-], 0 .. 1; 1; used by CONSERVING */
    bool restitution_of_law;         /* instead: u3 / u0 of the collision, 0 .. 1; default false */
    bool approaching_only;           /* END_OF_STEP: pairs that move apart have no event; default true */
    double stirring;                 /* share of the granules that get a new velocity in a second [1/s], >= 0; 0 */
    double consolidation;            /* k_c [1/s], >= 0; 0.0425 */
    bool breakage;                   /* default true */
    double breakage_least_volume;    /* a granule below it does not break [m3], >= 0; 1e-12 */
    int breakage_rest;               /* steps in which a daughter does not break again, >= 0; 0 */
    int most_granules;               /* >= 1; 4000000: above it breakage stops with GRANULATION_POPULATION */
    int64_t most_events;             /* collisions in a step a granule (of those at its start), 1 .. 1e9; 1000 */
    int place_attempts;              /* random places tried for a granule, >= 1; 2000 */
    uint64_t seed;                   /* 1 */
    void (*on_collision)(void *user, const granulation_event *event); /* may be NULL; must not change the simulation */
    void *collision_user;
    granulation_memory memory; /* default: malloc */
    uint64_t cookie;           /* set by granulation_default_def; leave it */
} granulation_def;

/* Counts since the start, or since they were set to zero by the host. */
typedef struct granulation_tally {
    int64_t interactions; /* collisions */
    int64_t by_reason[GRANULATION_REASON_COUNT];
    int64_t both; /* Type I that fits the printed criterion of Type II as well */
    int64_t breakages;
    int64_t refused_breakages; /* by breakage_least_volume or breakage_rest */
    double kinetic_loss;       /* by coalescence and restitution [J]; negative never */
} granulation_tally;

/* Amounts that crossed the boundary of the system since the start: sum over granules = placed + ledger,
   to round-off. */
typedef struct granulation_ledger {
    double solid, liquid, air; /* in [m3] */
    double air_released;       /* by consolidation and by liquid that took its place [m3] */
    double momentum[3];        /* brought in: placed, stirred, with liquid and air, and the defect of
                                  GRANULATION_REVERSAL [kg m/s] */
    double reversal_defect[3]; /* that defect alone [kg m/s] */
} granulation_ledger;

typedef struct granulation_sim {
    granulation_def def; /* may be changed between steps by granulation_sim_set; read freely */
    int n;               /* granules */
    int64_t steps;
    double time;            /* [s] */
    double owed;            /* after a run that was stopped: the rest of the motion in the last step [s of path], which
                               the next run does first; 0: none. That step has consolidated and counts in time; it
                               counts in steps when it is whole (with END_OF_STEP collisions may be left; time is then a
                               step ahead of steps) */
    double *x, *y, *z;      /* centres [m], 0 <= x < box; [n] */
    double *vx, *vy, *vz;   /* [m/s]; [n] */
    granulation_body *body; /* [n] */
    int64_t *broken;        /* step of the last breakage, negative: never; [n] */
    granulation_tally tally;
    granulation_ledger ledger;
    granulation_random random;
    /* below: private */
    int capacity, cells, item_capacity, event_capacity, hit_capacity;
    int64_t events; /* in the heap */
    int stage;      /* of a step that was stopped: GRANULATION__BEGIN ... */
    int *cell_start;
    void *items, *heap, *hits, *motion;
} granulation_sim;

/* Returns the paper's set-up with physically sound collisions: swept, momentum conserved, sum of radii. */
GRANULATION_API granulation_def granulation_default_def(void);
/* Returns the readings under which the paper's Tables 2 and 3 come out (set G1): end of step, larger
   radius, reversal. */
GRANULATION_API granulation_def granulation_paper_def(void);
GRANULATION_API granulation_status granulation_check_def(const granulation_def *def, const char **field);

/* Makes a simulation without granules; nothing is allocated yet. One in use must be freed first. BAD_DEF. After an
   error *sim is empty and may be freed. */
GRANULATION_API granulation_status granulation_sim_init(granulation_sim *sim, const granulation_def *def);
GRANULATION_API void granulation_sim_free(granulation_sim *sim); /* safe to call twice */

/* Places `count` granules without overlap, velocities from the distribution. BAD_ARGUMENT, TOO_LARGE, NO_ROOM,
   NO_MEMORY: those placed before it stay. */
GRANULATION_API granulation_status granulation_sim_add(granulation_sim *sim, const granulation_granule *g, int count);
/* Does the same for an array [n] of granules, in its order; faster than one by one. */
GRANULATION_API granulation_status granulation_sim_add_many(granulation_sim *sim, const granulation_granule *granules,
                                                            int n);
/* Adds one granule at a centre [m] (wrapped into the box) with a velocity [m/s], overlap or not. */
GRANULATION_API granulation_status granulation_sim_put(granulation_sim *sim, const granulation_granule *g,
                                                       const double centre[3], const double velocity[3]);

/* Runs `steps` steps. Stops at the first status that is not ok: TOO_LARGE, POPULATION, EVENTS, NO_MEMORY. The state is
   then whole (volumes, momentum) and of the time sim->time; only the motion sim->owed is left of the last step. A later
   run does that first, then its own steps: nothing is done twice. */
GRANULATION_API granulation_status granulation_sim_run(granulation_sim *sim, int steps);

/* Changes in mid-run. All check their arguments and change nothing if they refuse. */
/* all but box, seed and memory */
GRANULATION_API granulation_status granulation_sim_set(granulation_sim *sim, const granulation_def *def);
/* Changes the impeller: new mean and deviation [m/s]; every granule keeps its deviate, v' = mean' + (v - mean)
   deviation' / deviation (a new draw where the deviation was 0), or with redraw a new velocity. */
GRANULATION_API granulation_status granulation_sim_impeller(granulation_sim *sim, const double mean[3],
                                                            const double deviation[3], bool redraw);
/* Sprays binder: volume [m3] >= 0 in all, distributed by granule surface; displaced 0 .. 1: share of it that enters
   pores and drives out air. BAD_ARGUMENT, TOO_LARGE. */
GRANULATION_API granulation_status granulation_sim_spray(granulation_sim *sim, double volume, double displaced);

/* Returns the mean diameter (sum D^p / sum D^q)^(1/(p-q)) [m]: (4,3) volume weighted, (1,0) number, (3,2)
   Sauter. 0 <= q < p <= 6, else NaN; NaN when empty. */
GRANULATION_API double granulation_sim_mean(const granulation_sim *sim, int p, int q);
/* Returns the diameter [m] up to which granules contain a share, in (0, 1], of the total volume: the diameter of the
   granule that reaches it. Median size: 0.5. NaN when empty. */
GRANULATION_API double granulation_sim_percentile(const granulation_sim *sim, double share);
/* Sums by class of volume: class k contains edges[k] <= V < edges[k+1] [m3], edges [classes+1] increasing; count, q_s,
   q_l, q_a [classes] may be NULL. Returns the number of granules outside, which are left out. */
GRANULATION_API int granulation_sim_classes(const granulation_sim *sim, const double *edges, int classes, double *count,
                                            double *q_s, double *q_l, double *q_a);
GRANULATION_API void granulation_sim_totals(const granulation_sim *sim, granulation_granule *volumes,
                                            double momentum[3], double *kinetic); /* any NULL */
/* Computes the coalescence boundary map of the present population: the outcome of a collision of two mean granules
   (film, diameter, yield stress) at each pair of Stokes numbers; st_v [rows], st_def [columns], all > 0;
   reasons [rows][columns]. The size limit is left out.
   BAD_ARGUMENT: no granules. */
GRANULATION_API granulation_status granulation_sim_map(const granulation_sim *sim, const double *st_v, int rows,
                                                       const double *st_def, int columns, granulation_reason *reasons);
/* Finds the deepest overlap of a pair over the sum of its radii [-]; 0: none. */
GRANULATION_API granulation_status granulation_sim_overlap(granulation_sim *sim, double *deepest);

/* ---- the range of the fit ---- */
/* clang-format off */
/* Material and rules of granulation_paper_def were fitted to the paper's Tables 2 and 3. Elsewhere a result is an
   extrapolation, in: */
#define GRANULATION_OUTSIDES(X)                                                                       \
    X(GRANULATION_OUTSIDE_SPEED, 1, "mean velocity outside the fitted 1 .. 7 m/s, 120 .. 840 1/min")  \
    X(GRANULATION_OUTSIDE_BINDER, 2, "binder outside the fitted 15 .. 33 % of the feed")              \
    X(GRANULATION_OUTSIDE_SIZE, 4, "mean size d43 outside the fitted 180 .. 245 um")                  \
    X(GRANULATION_OUTSIDE_FILL, 8, "granules fill less than 6 or more than 9 % of the box")           \
    X(GRANULATION_OUTSIDE_TIME, 16, "longer than the fitted 100 s")                                   \
    X(GRANULATION_OUTSIDE_MATERIAL, 32, "another material than the fitted one")                       \
    X(GRANULATION_OUTSIDE_RULES, 64, "other rules of motion and contact than the fitted ones")
/* clang-format on */
enum granulation_outside_flag {
#define GRANULATION__FLAG(name, value, text) name = value,
    GRANULATION_OUTSIDES(GRANULATION__FLAG)
#undef GRANULATION__FLAG
        GRANULATION_OUTSIDE_NOTHING = 0
};
/* Returns the flags of quantities that lie outside the fit at present, by more than 1 % of the limit. The share of
   binder is that of l / (s + l), which consolidation keeps. Without granules: speed, time, material and rules only. 0
   for NULL. */
GRANULATION_API unsigned granulation_sim_outside(const granulation_sim *sim);
GRANULATION_API const char *granulation_outside_text(unsigned flag); /* of one flag; never NULL; static storage */

/* ---- ensembles ---- */
/* One replicate in numbers. */
typedef struct granulation_replicate {
    double type1, type2, rebound, both; /* share of the interactions [%]; 0 without interactions */
    double mean_size;                   /* d43 at the end [m] */
    double interactions, breakages, granules;
    double d10, d30, d32; /* mean diameters by number, of the mean volume, of Sauter, at the end [m] */
    double x10, x50, x90; /* percentiles by volume [m] */
    double span;          /* (x90 - x10)/x50 [-] */
} granulation_replicate;
#define GRANULATION_REPLICATE_FIELDS 15 /* doubles in it, in this order */
static inline granulation_replicate granulation_replicate_of(const granulation_sim *sim);
/* Mean, standard deviation and half width of the 95 % confidence interval (Student) of n >= 1 numbers, `stride` apart;
   the latter two are 0 for n = 1. */
typedef struct granulation_estimate {
    double mean, deviation, confidence;
} granulation_estimate;
static inline granulation_estimate granulation_estimate_of(const double *values, int n, int stride);

/* ==== >>balance: population balances ==== */

/* Rate constant of coalescence of two granules [m3/s]; symmetric, >= 0. The granules are the means of their cells.
   Kernels and rates of breakage must not change the balance. */
typedef double (*granulation_kernel)(const granulation_granule *i, const granulation_granule *j, const void *user);

/* Data of the kernels below, passed as `data` (def.kernel_user of a balance). Made by
   granulation_default_kernel_data(). A kernel that lacks a number is NaN; a run then returns GRANULATION_KERNEL. */
typedef struct granulation_kernel_data {
    double rate;                  /* factor of every kernel, >= 0; its unit makes the kernel [m3/s]; default 1 */
    double a, b;                  /* exponents of Kapur [-]. Class: factors b1, b2 [-], >= 0. Default NaN: must be set
                                     for these two */
    double limit;                 /* cutoff, saturation: no coalescence above this diameter of the granule formed [m];
                                     default infinite */
    double speed;                 /* class, collision: relative speed [m/s], >= 0; default NaN: must be set
                                     for these two */
    const granulation_laws *laws; /* class; saturation (critical_saturation); default NULL: must be set for these
                                     two; not owned */
    granulation_kernel inner;     /* class, cutoff, saturation: times this kernel of the same data; default NULL:
                                     the rate alone */
} granulation_kernel_data;

GRANULATION_API granulation_kernel_data granulation_default_kernel_data(void);

/* u, v: whole volumes of the two [m3]; D1, D2: their diameters [m]. */
static inline double granulation_constant_kernel(const granulation_granule *i, const granulation_granule *j,
                                                 const void *data);
/* u + v */
static inline double granulation_sum_kernel(const granulation_granule *i, const granulation_granule *j,
                                            const void *data);
/* u v */
static inline double granulation_product_kernel(const granulation_granule *i, const granulation_granule *j,
                                                const void *data);
/* (u^1/3 + v^1/3)^3 */
static inline double granulation_shear_kernel(const granulation_granule *i, const granulation_granule *j,
                                              const void *data);
/* Equipartition of kinetic energy, Hounslow (1998): (u^1/3 + v^1/3)^2 (1/u + 1/v)^1/2 */
static inline double granulation_eke_kernel(const granulation_granule *i, const granulation_granule *j,
                                            const void *data);
/* Brownian: (u^1/3 + v^1/3)(u^-1/3 + v^-1/3) */
static inline double granulation_brownian_kernel(const granulation_granule *i, const granulation_granule *j,
                                                 const void *data);
/* (u + v)^a / (u v)^b */
static inline double granulation_kapur_kernel(const granulation_granule *i, const granulation_granule *j,
                                              const void *data);
/* Hard spheres at one relative speed: (pi / 4) (D1 + D2)^2 speed [m3/s] */
static inline double granulation_collision_kernel(const granulation_granule *i, const granulation_granule *j,
                                                  const void *data);
/* Adetayo and Ennis (1997): inner, 0 above the limit */
static inline double granulation_cutoff_kernel(const granulation_granule *i, const granulation_granule *j,
                                               const void *data);
/* Pouw et al. (2002): inner where both saturations have reached the critical one, 0 above the limit */
static inline double granulation_saturation_kernel(const granulation_granule *i, const granulation_granule *j,
                                                   const void *data);
/* Liu and Litster (2002): a inner for Type I and elastic Type II, b inner for plastic and dry Type II, 0 for rebound;
   their b1, b2 */
static inline double granulation_class_kernel(const granulation_granule *i, const granulation_granule *j,
                                              const void *data);

typedef enum granulation_scheme { GRANULATION_CELL_AVERAGE, GRANULATION_FIXED_PIVOT } granulation_scheme;
/* Daughters: two halves (36); two, one with a volume uniform on 0 .. u (b(v|u) = 2/u); or those of a function of your
   own. The last two: one-component grids only. */
typedef enum granulation_daughters { GRANULATION_HALVES, GRANULATION_UNIFORM, GRANULATION_OWN } granulation_daughters;
/* Returns the share of a mother's volume in daughters with less than z of hers, 0 <= z <= 1: it does not fall, and is 1
   at z = 1. mother: volume without air [m3]. A function that breaks this makes a run return KERNEL. */
typedef double (*granulation_breakage)(double z, double mother, const void *user);
/* Austin and Luckie (1972): phi r^gamma + (1 - phi) r^beta, r = z^(1/3) the ratio of the diameters. data:
   granulation_austin. Its moments of order p exist for gamma, beta > 3 (1 - p): with less than 3 the number of fines
   has no bound but the first pivot. */
typedef struct granulation_austin {
    double phi;         /* share of the fines, 0 .. 1 */
    double gamma, beta; /* exponents of fines and of large fragments, > 0 */
} granulation_austin;
static inline double granulation_austin_breakage(double z, double mother, const void *data);

typedef struct granulation_balance_def {
    granulation_scheme scheme; /* default CELL_AVERAGE; breakage is fixed pivot in both */
    granulation_kernel kernel; /* NULL: no coalescence; default constant */
    const void *kernel_user;   /* data of the kernel; default NULL: rate 1, for the kernels above that need no
                                  more. Not owned */
    bool kernel_changes;       /* it depends on the composition, so it is evaluated again before each step; default
                                  false */
    double (*selection)(const granulation_granule *g, const void *user); /* rate of breakage [1/s]; NULL: none;
                                                                            default NULL */
    const void *selection_user;
    granulation_daughters daughters; /* default HALVES */
    granulation_breakage breakage;   /* OWN: needed; default NULL. Evaluated with the kernel, 32 times
                                        between two pivots */
    const void *breakage_user;       /* its data; not owned */
    double consolidation;            /* k_c [1/s], >= 0; 0 */
    double tolerance;                /* of a step, of the moments 0, 1, 2 of its error [-], > 0; 1e-6 */
    double longest_step;             /* [s], > 0; infinite */
    double most_lost;                /* share of the solid volume above the last pivot at which it stops with
                                        GEL, 0 .. 1; 1e-3 */
    int most_steps;                  /* in a run, >= 1; 1000000 */
    granulation_memory memory;
    uint64_t cookie;
} granulation_balance_def;

/* One component: the key of a granule is its volume without air, s + l; liquid and air are carried as totals of the
   cell, so consolidation does not move granules. Two components: the keys are s and l; air is carried. */
typedef struct granulation_balance {
    granulation_balance_def def;
    int components;         /* 1 or 2 */
    int size[2];            /* cells along each key; size[1] is 1 with one component */
    int n;                  /* cells: cell i + size[0] j has the keys pivot[0][i], pivot[1][j] */
    double *edge[2];        /* [size+1] [m3] */
    double *pivot[2];       /* [size] [m3] */
    double *number;         /* granules in a cell [1/m3 of the vessel, or any unit that the kernel matches]; [n] */
    double *liquid;         /* total liquid of the cell, in number times m3; [n]; NULL with two components: see
                               granulation_balance_cell */
    double *air;            /* total air; [n] */
    double time;            /* [s] */
    int64_t steps, refused; /* of the integrator */
    double lost_number;     /* granules that grew beyond the last pivot */
    granulation_granule lost, total; /* their volumes; all volumes ever added */
    double air_released;
    double next_step; /* [s] first step size that the integrator tries next; 0: it chooses; negative: the same, and the
                         kernel is evaluated again */
    /* below: private */
    int64_t pairs;
    int *target;
    double *share, *kernel, *state, *work, *births;
    size_t bytes[9];
} granulation_balance;

GRANULATION_API granulation_balance_def granulation_balance_default_def(void);
GRANULATION_API granulation_status granulation_balance_check_def(const granulation_balance_def *def,
                                                                 const char **field);
/* Makes an empty balance. edges: increasing, >= 0 [m3], [cells+1], cells >= 2. pivots: inside their cells,
   increasing, > 0 (the first of the liquid may be 0), [cells]; NULL: the middle of each cell. l_cells 0 (l_edges NULL):
   one component. At most 100000 cells in all. Copies all. A balance in use must be freed first. After an error *b is
   empty and may be freed. Needs 12 bytes a pair of cells (20 or 28 with the fixed pivot). */
GRANULATION_API granulation_status granulation_balance_init(granulation_balance *b, const granulation_balance_def *def,
                                                            int cells, const double *edges, const double *pivots,
                                                            int l_cells, const double *l_edges, const double *l_pivots);
GRANULATION_API void granulation_balance_free(granulation_balance *b);
/* Adds `number` >= 0 granules; they are shared between neighbouring pivots so that number and every volume is kept. A
   granule on a pivot goes to that cell alone. Outside the pivots: BAD_ARGUMENT. */
GRANULATION_API granulation_status granulation_balance_add(granulation_balance *b, const granulation_granule *g,
                                                           double number);
/* Runs to the time b->time + duration [s], duration >= 0. GEL, STEP, KERNEL: it stopped at b->time with a complete
   state. However late the time, the whole duration is run. */
GRANULATION_API granulation_status granulation_balance_run(granulation_balance *b, double duration);
GRANULATION_API granulation_status granulation_balance_set(granulation_balance *b,
                                                           /* a change in mid-run; not the memory */
                                                           const granulation_balance_def *def);
/* Returns the mean granule of a cell; of an empty one its keys (and no liquid with one component). */
static inline granulation_granule granulation_balance_cell(const granulation_balance *b, int cell);
/* Returns the number of granules in a cell, in the unit in which they were added; NaN for one that is not there. */
GRANULATION_API double granulation_balance_number(const granulation_balance *b, int cell);
/* Returns the sum number key0^p key1^q, 0^0 = 1; p, q >= 0. With one component q must be 0. Else NaN. */
GRANULATION_API double granulation_balance_moment(const granulation_balance *b, double p, double q);
GRANULATION_API granulation_granule granulation_balance_totals(const granulation_balance *b);
/* mean diameter [m] as granulation_sim_mean */
GRANULATION_API double granulation_balance_mean(const granulation_balance *b, int p, int q);

/* ==== >>montecarlo: constant-number Monte Carlo ==== */
/* n sample granules in a volume; after each coalescence one of them is doubled and the volume grows by n / (n - 1).
   Volumes are kept in the mean only. */
typedef struct granulation_montecarlo {
    int n;
    granulation_granule *granules; /* [n] */
    double volume;                 /* that the sample stands for [m3] */
    double time;                   /* [s] */
    int64_t events, raised;        /* coalescences; times the bound of the kernel was found too small (a
                                      bias, if often) */
    granulation_kernel kernel;
    const void *user;
    granulation_random random;
    granulation_memory memory;
    double bound;                          /* of the kernel over all pairs */
    granulation_granule smallest, largest; /* ever drawn or made: the bound is computed from pairs with these */
} granulation_montecarlo;

/* Starts a run. One in use must be freed first. sample [n] is copied, n >= 2; volume > 0; memory may be NULL.
   BAD_ARGUMENT, NO_MEMORY, KERNEL. */
GRANULATION_API granulation_status granulation_montecarlo_init(granulation_montecarlo *mc,
                                                               const granulation_granule *sample, int n, double volume,
                                                               granulation_kernel kernel, const void *user,
                                                               uint64_t seed, const granulation_memory *memory);
GRANULATION_API void granulation_montecarlo_free(granulation_montecarlo *mc);
/* Runs to the time mc->time + duration [s], duration >= 0. BAD_ARGUMENT, KERNEL, STEP: more than 1e9 pairs would have
   to be drawn (reported before drawing). However late the time, the whole duration is run. */
GRANULATION_API granulation_status granulation_montecarlo_run(granulation_montecarlo *mc, double duration);
/* Returns the moment sum V^p / volume [m3^p per m3]; V: whole volumes. */
GRANULATION_API double granulation_montecarlo_moment(const granulation_montecarlo *mc, double p);

/* Computes mean and 95 % range (Student) of a result of n >= 2 runs that differ in their seeds: a moment, a mean
   diameter, a percentile of a sample, or of the discrete simulation. One run alone has no range: its granules are not
   independent of each other. The range holds what random numbers do; that of a population balance is its mesh (run it
   with twice the cells), that of its rates is not known here. mean, low, high: NaN unless GRANULATION_OK; BAD_ARGUMENT
   for n < 2 or a value that is not finite. */
GRANULATION_API granulation_status granulation_range(const double *values, int n, double *mean, double *low,
                                                     double *high);

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

/* ---- >>laws, bodies: inline in every mode ---- */

static inline double granulation_volume(const granulation_granule *g) { return g->s + g->l + g->a; }
static inline double granulation_diameter(double volume) {
    return volume >= 0.0 ? riddle_cbrt(volume * (6.0 / RIDDLE_PI)) : (double)NAN;
}
static inline double granulation_sphere(double diameter) {
    return diameter >= 0.0 ? RIDDLE_PI / 6.0 * (diameter * diameter * diameter) : (double)NAN;
}

static inline bool granulation__is_granule(const granulation_granule *g) {
    return g->s > 0.0 && g->l >= 0.0 && g->a >= 0.0 && g->s + g->l + g->a < HUGE_VAL;
}

static inline double granulation_porosity(const granulation_granule *g) {
    return granulation__is_granule(g) ? (g->l + g->a) / granulation_volume(g) : (double)NAN;
}
static inline double granulation_saturation(const granulation_granule *g) {
    if (!granulation__is_granule(g)) return (double)NAN;
    return g->l + g->a > 0.0 ? g->l / (g->l + g->a) : 1.0;
}
static inline double granulation_liquid_fraction(const granulation_granule *g) {
    return granulation__is_granule(g) ? g->l / granulation_volume(g) : (double)NAN;
}
static inline double granulation_moisture(const granulation_granule *g) {
    return granulation__is_granule(g) ? g->l / g->s : (double)NAN;
}
static inline double granulation_least_porosity(const granulation_granule *g) {
    return granulation__is_granule(g) ? g->l / (g->s + g->l) : (double)NAN;
}
static inline double granulation_mass(const granulation_granule *g, double solid, double liquid, double air) {
    return granulation__is_granule(g) && solid >= 0.0 && liquid >= 0.0 && air >= 0.0
               ? solid * g->s + liquid * g->l + air * g->a
               : (double)NAN;
}

static inline double granulation_film_unclipped(const granulation_granule *g, double s_crit) {
    if (!granulation__is_granule(g) || !(s_crit > 0.0 && s_crit <= 1.0)) return (double)NAN;
    double d = granulation_diameter(granulation_volume(g));
    return (g->l * (1.0 - s_crit) - s_crit * g->a) / (RIDDLE_PI * d * d);
}
static inline double granulation_film(const granulation_granule *g, double s_crit) {
    double h = granulation_film_unclipped(g, s_crit);
    return h < 0.0 ? 0.0 : h;
}
static inline double granulation_asperity(double factor, double grain_diameter) {
    return factor > 0.0 && grain_diameter > 0.0 ? factor * grain_diameter : (double)NAN;
}

static inline double granulation_consolidation_rate(const granulation_granule *g, double rate_constant) {
    if (!granulation__is_granule(g) || !(rate_constant >= 0.0)) return (double)NAN;
    double v = granulation_volume(g);
    return -rate_constant * ((g->l + g->a) * v / g->s - granulation_least_porosity(g) * v * v / g->s);
}

/* Returns the air volume a decay w / (w + a (1 - decay)), w = s + l: the solution of (27) without a difference of
   nearly equal numbers. */
static inline double granulation__consolidated(double wet, double air, double decay) {
    return air * decay * (wet / (wet + air * (1.0 - decay)));
}

static inline double granulation_consolidate(const granulation_granule *g, double kt) {
    if (!granulation__is_granule(g) || !(kt >= 0.0)) return (double)NAN;
    return granulation__consolidated(g->s + g->l, g->a, riddle_exp(-kt));
}

static inline double granulation_film_time(const granulation_granule *g, double s_crit) {
    if (!granulation__is_granule(g) || !(s_crit > 0.0 && s_crit <= 1.0)) return (double)NAN;
    double wet = g->s + g->l, critical = g->l * (1.0 / s_crit - 1.0); /* air left when the film appears */
    if (g->a <= critical) return 0.0;
    if (!(critical > 0.0)) return HUGE_VAL;
    return riddle_log((g->a / (g->a + wet)) / (critical / (critical + wet)));
}

static inline double granulation_hertz_pressure(double force, double modulus, double diameter) {
    if (!(force >= 0.0 && modulus > 0.0 && diameter > 0.0)) return (double)NAN;
    double stiff = modulus / diameter;
    return riddle_cbrt(24.0 * force * stiff * stiff) / RIDDLE_PI;
}
static inline double granulation_contact_compliance(double e1, double nu1, double e2, double nu2) {
    if (!(e1 > 0.0 && e2 > 0.0 && nu1 >= -1.0 && nu1 <= 0.5 && nu2 >= -1.0 && nu2 <= 0.5)) return (double)NAN;
    return (1.0 - nu1 * nu1) / e1 + (1.0 - nu2 * nu2) / e2;
}
static inline double granulation_effective_modulus(double e1, double nu1, double e2, double nu2) {
    return 1.0 / granulation_contact_compliance(e1, nu1, e2, nu2);
}
static inline double granulation_edge_tension(double pressure, double poisson) {
    return pressure >= 0.0 && poisson >= -1.0 && poisson <= 0.5 ? (1.0 - 2.0 * poisson) * pressure / 3.0 : (double)NAN;
}
static inline double granulation_rumpf_strength(double porosity, double saturation, double shape, double tension,
                                                double angle, double grain) {
    if (!(porosity > 0.0 && porosity < 1.0 && saturation >= 0.0 && saturation <= 1.0 && shape > 0.0 && tension >= 0.0 &&
          grain > 0.0 && angle >= 0.0 && angle <= 0.5 * RIDDLE_PI))
        return (double)NAN;
    return (1.0 - porosity) / porosity * (saturation * shape * tension / grain) * riddle_cos(angle);
}
static inline double granulation_yield_stress(double strength, double poisson) {
    return strength >= 0.0 && poisson >= -1.0 && poisson < 0.5 ? 2.0 * strength / (3.0 - 6.0 * poisson) : (double)NAN;
}

static inline double granulation_reduced(double a, double b) {
    if (!(a > 0.0 && b > 0.0)) return (double)NAN;
    return a < b ? a / (1.0 + a / b) : b < HUGE_VAL ? b / (1.0 + b / a) : HUGE_VAL;
}
static inline double granulation_viscous_stokes(granulation_convention c, double m, double u0, double viscosity,
                                                double d) {
    if (!(m > 0.0 && u0 >= 0.0 && viscosity > 0.0 && d > 0.0)) return (double)NAN;
    return (c == GRANULATION_PRINTED ? 8.0 : 4.0) * m * u0 / (3.0 * RIDDLE_PI * viscosity * d * d);
}
static inline double granulation_deformation_stokes(double m, double u0, double d, double yield) {
    if (!(m > 0.0 && u0 >= 0.0 && d > 0.0 && yield > 0.0)) return (double)NAN;
    return m * u0 * u0 / (2.0 * (d * d * d) * yield);
}
static inline double granulation_film_logarithm(double h0, double ha) {
    if (!(h0 >= 0.0 && ha > 0.0)) return (double)NAN;
    return h0 > ha ? riddle_log(h0 / ha) : 0.0;
}
static inline double granulation_approach_speed(double u0, double st_v, double log_film) {
    return st_v > 0.0 && log_film >= 0.0 ? u0 * (1.0 - log_film / st_v) : (double)NAN;
}
static inline bool granulation_is_type_one(double st_v, double log_film) { return log_film > 0.0 && st_v <= log_film; }
static inline double granulation_contact_area(double u1, double m, double d, double yield) {
    if (!(u1 >= 0.0 && m > 0.0 && d > 0.0 && yield > 0.0)) return (double)NAN;
    return 2.0 * u1 * sqrt(RIDDLE_PI * m * d / (3.0 * yield));
}
static inline double granulation_deformation(double area, double d, double yield_ratio) {
    if (!(area >= 0.0 && d > 0.0 && yield_ratio >= 0.0)) return (double)NAN;
    return area / (RIDDLE_PI * d) - 2.25 * yield_ratio * sqrt(RIDDLE_PI * area);
}
static inline double granulation_relative_deformation(double st_def, double b, double yield_ratio) {
    if (!(st_def >= 0.0 && b >= 0.0 && yield_ratio >= 0.0)) return (double)NAN;
    double root = sqrt(b * sqrt(st_def * (8.0 / (3.0 * RIDDLE_PI)))); /* of the largest compression over d */
    return root * (root - 2.25 * RIDDLE_PI * yield_ratio);
}
static inline double granulation_rebound_speed(double u0, double b, double yield_ratio, double st_def) {
    if (!(u0 >= 0.0 && b >= 0.0 && yield_ratio >= 0.0 && st_def >= 0.0)) return (double)NAN;
    double u1 = b * u0, b_half = sqrt(b);
    double u2 = GRANULATION_JOHNSON * u0 * sqrt(yield_ratio) / sqrt(sqrt(sqrt(st_def))) * (b_half * sqrt(b_half));
    return u2 < u1 ? u2 : u1;
}
static inline double granulation_separation_speed(granulation_convention c, double u2, double u0, double st_v,
                                                  double deformation, double h0, double ha) {
    if (!(st_v > 0.0 && deformation >= 0.0 && ha > 0.0 && h0 >= ha)) return (double)NAN;
    double one = c == GRANULATION_PRINTED ? 0.5 : 0.125, two = c == GRANULATION_PRINTED ? 1.0 : 0.5;
    double near_end = deformation / ha, far_end = deformation / h0;
    double loss = one * (near_end - far_end) * (near_end + far_end) + two * (near_end - far_end) +
                  granulation_film_logarithm(h0, ha);
    return u2 - u0 / st_v * loss;
}
static inline double granulation_dry_separation_speed(granulation_convention c, double u2, double u0, double st_v,
                                                      double deformation, double ha) {
    if (!(st_v > 0.0 && ha > 0.0) || deformation != deformation) return (double)NAN;
    double ratio = deformation / ha;
    if (ratio <= 1.0) return u2;
    return u2 - u0 / st_v * (c == GRANULATION_PRINTED ? 0.5 : 0.125) * (ratio - 1.0) * (ratio + 1.0);
}
static inline bool granulation_is_elastic_type_two(double st_v, double log_film) {
    return log_film > 0.0 && st_v < 2.0 * log_film;
}

static inline double granulation_printed_left(double yield_ratio, double st_def) {
    if (!(yield_ratio >= 0.0 && st_def > 0.0)) return (double)NAN;
    return sqrt(yield_ratio) / (st_def * sqrt(sqrt(sqrt(st_def))));
}
static inline double granulation_printed_right(double st_v, double st_def, double yield_ratio, double b, double d,
                                               double deformation, double h0, double ha) {
    double log_film = granulation_film_logarithm(h0, ha);
    if (!(st_v > 0.0 && b > 0.0 && st_def > 0.0 && yield_ratio >= 0.0 && d > 0.0 && h0 >= ha) || deformation == 0.0)
        return (double)NAN;
    double q = h0 / ha, p = h0 / deformation, w = d / h0;
    double held = 1.0 - 7.36 * yield_ratio / sqrt(sqrt(st_def)) / sqrt(b);
    return 0.172 / st_v * w * w * (b * sqrt(sqrt(b))) * (q * q - 1.0 + 2.0 * p * (q - 1.0) + 2.0 * p * p * log_film) *
           held * held;
}

static inline double granulation_film_force(granulation_convention c, double d, double viscosity, double u,
                                            double gap) {
    if (!(d > 0.0 && viscosity >= 0.0 && u >= 0.0 && gap >= 0.0)) return (double)NAN;
    return (c == GRANULATION_PRINTED ? 0.75 : 3.0) * RIDDLE_PI * d * d * viscosity * u / gap;
}
static inline double granulation_bond_area(double d, double deformation) {
    return d > 0.0 && deformation >= 0.0 ? RIDDLE_PI * d * deformation : (double)NAN;
}
static inline double granulation_critical_diameter(double a1_factor, double exponent, double k, double strength) {
    if (!(a1_factor >= 0.0 && exponent > 0.0 && k >= 0.0 && strength >= 0.0)) return (double)NAN;
    return a1_factor * riddle_pow(k * sqrt(k) * strength, exponent);
}
static inline double granulation_tip_speed(granulation_convention c, double turns, double diameter) {
    if (!(diameter > 0.0) || turns != turns) return (double)NAN;
    return (c == GRANULATION_PRINTED ? 0.5 : RIDDLE_PI) * turns * diameter;
}
static inline double granulation_breakage_stokes(double density, double speed, double yield) {
    return density > 0.0 && yield >= 0.0 ? RIDDLE_PI * density * speed * speed / (12.0 * yield) : (double)NAN;
}
static inline double granulation_herschel_bulkley(double yield, double consistency, double shear_rate, double index) {
    if (!(yield >= 0.0 && consistency >= 0.0 && shear_rate >= 0.0 && index >= 0.0)) return (double)NAN;
    return consistency > 0.0 ? yield + consistency * riddle_pow(shear_rate, index) : yield;
}
static inline double granulation_kozeny_strain(double porosity, double density, double speed, double d32,
                                               double viscosity) {
    if (!(porosity >= 0.0 && porosity < 1.0 && density > 0.0 && speed >= 0.0 && d32 > 0.0 && viscosity > 0.0))
        return (double)NAN;
    return sqrt(porosity * porosity * porosity / (540.0 * (1.0 - porosity) * (1.0 - porosity)) *
                (density * speed * d32 / viscosity));
}
static inline granulation_granule granulation_half(const granulation_granule *g) {
    granulation_granule h;
    h.s = 0.5 * g->s;
    h.l = 0.5 * g->l;
    h.a = 0.5 * g->a;
    return h;
}
static inline granulation_granule granulation_sum(const granulation_granule *a, const granulation_granule *b) {
    granulation_granule g;
    g.s = a->s + b->s;
    g.l = a->l + b->l;
    g.a = a->a + b->a;
    return g;
}
static inline double granulation_arrhenius(double viscosity, double activation, double temperature, double reference) {
    if (!(viscosity > 0.0 && activation >= 0.0 && temperature > 0.0 && reference > 0.0)) return (double)NAN;
    return viscosity * riddle_exp(activation * (1.0 / temperature - 1.0 / reference));
}

/* Returns C gamma cos(theta) / Dp of (16), which is the same for every granule. */
static inline double granulation__capillary(const granulation_laws *laws) {
    return laws->shape_factor * laws->surface_tension / laws->grain_diameter * riddle_cos(laws->contact_angle);
}

static inline granulation_body granulation__body(const granulation_laws *laws, const granulation_granule *g,
                                                 double capillary) {
    granulation_body b;
    double pores = g->l + g->a, volume = g->s + pores, critical = laws->critical_saturation;
    b.volumes = *g;
    b.diameter = riddle_cbrt(volume * (6.0 / RIDDLE_PI));
    b.mass = laws->solid_density * g->s + laws->liquid_density * g->l + laws->air_density * g->a;
    double free_liquid = g->l * (1.0 - critical) - critical * g->a;
    b.film = free_liquid > 0.0 ? free_liquid / (RIDDLE_PI * b.diameter * b.diameter) : 0.0;
    /* (1 - eps) / eps S = s l / (l + a)^2 */
    b.strength = pores > 0.0 ? (g->s / pores) * (g->l / pores) * capillary : HUGE_VAL;
    b.yield = 2.0 * b.strength / (3.0 - 6.0 * laws->poisson);
    return b;
}

static inline granulation_body granulation_body_of(const granulation_laws *laws, const granulation_granule *g) {
    granulation_body b = granulation__body(laws, g, granulation__capillary(laws));
    if (!granulation__is_granule(g)) b.diameter = b.mass = b.film = b.strength = b.yield = (double)NAN;
    return b;
}

static inline granulation_body granulation_wall(double film) {
    granulation_body b;
    memset(&b, 0, sizeof b);
    b.diameter = b.mass = b.strength = b.yield = HUGE_VAL;
    b.film = film >= 0.0 ? film : (double)NAN;
    return b;
}

static inline double granulation__pair_yield(granulation_pair_yield rule, double a, double b) {
    if (rule == GRANULATION_YIELD_WEAKER || !(a < HUGE_VAL && b < HUGE_VAL)) return a < b ? a : b;
    return 0.5 * (a + b);
}

/* Decides whether a film would hold granules that meet at B = u1 / u0. Sets u2, u3, deformation and reason. All inputs
   have been checked. */
static inline void granulation__contact(const granulation_laws *laws, double b, double ratio, double d, double h0,
                                        double ha, bool liquid, granulation_collision *c) {
    bool wet = h0 > ha;
    double relative = granulation_relative_deformation(c->st_def, b, ratio);
    c->deformation = relative * d;
    if (!(relative > 0.0)) { /* decided here, before any formula that squares the deformation or divides by it */
        c->u2 = b * c->u0;
        c->u3 = c->u0 * (1.0 - 2.0 * c->log_film / c->st_v);
        c->coalesces = wet && laws->elastic_rule && granulation_is_elastic_type_two(c->st_v, c->log_film);
        c->reason = c->coalesces ? GRANULATION_TYPE_II_ELASTIC
                    : wet        ? GRANULATION_REBOUND_ELASTIC
                                 : GRANULATION_REBOUND_DRY;
        return;
    }
    c->u2 = granulation_rebound_speed(c->u0, b, ratio, c->st_def);
    double film = laws->deep_film && c->deformation > h0 ? c->deformation : h0;
    if (!wet && !(laws->dry_rule && liquid)) c->u3 = c->u2;
    else if (wet || laws->deep_film)
        c->u3 = film > ha
                    ? granulation_separation_speed(laws->convention, c->u2, c->u0, c->st_v, c->deformation, film, ha)
                    : c->u2;
    else c->u3 = granulation_dry_separation_speed(laws->convention, c->u2, c->u0, c->st_v, c->deformation, ha);
    c->coalesces = c->u3 <= 0.0 && (wet || (laws->dry_rule && liquid));
    c->reason = wet ? (c->coalesces ? GRANULATION_TYPE_II_PLASTIC : GRANULATION_REBOUND_PLASTIC)
                    : (c->coalesces ? GRANULATION_TYPE_II_DRY : GRANULATION_REBOUND_DRY);
}

/* Decides the outcome of a collision; u0, st_v and st_def of c are set. */
static inline void granulation__decide(const granulation_laws *laws, double ratio, double d, double h0, double ha,
                                       bool liquid, granulation_collision *c) {
    c->reason = GRANULATION_NONE;
    if (!(c->st_v > 0.0 && c->st_def >= 0.0 && ratio >= 0.0 && h0 >= 0.0 && d > 0.0)) return;
    c->log_film = granulation_film_logarithm(h0, ha);
    c->u1 = granulation_approach_speed(c->u0, c->st_v, c->log_film);
    if (granulation_is_type_one(c->st_v, c->log_film)) { /* before B, whose powers do not exist here */
        double deformation = d * granulation_relative_deformation(c->st_def, 1.0, ratio);
        c->both = granulation_printed_left(ratio, c->st_def) <
                  granulation_printed_right(c->st_v, c->st_def, ratio, 1.0, d, deformation, h0, ha);
        c->coalesces = true;
        c->reason = GRANULATION_TYPE_I;
        return;
    }
    granulation__contact(laws, 1.0 - c->log_film / c->st_v, ratio, d, h0, ha, liquid, c);
}

static inline double granulation__limit(const granulation_laws *laws, const granulation_body *i,
                                        const granulation_body *j, double d, double h0,
                                        const granulation_collision *c) {
    double moisture = (i->volumes.l + j->volumes.l) / (i->volumes.s + j->volumes.s);
    double factor = laws->limit_diameter * sqrt(sqrt(moisture / laws->limit_moisture));
    if (laws->limit == GRANULATION_LIMIT_MOISTURE) return factor;
    if (!(c->deformation > 0.0 && h0 > 0.0)) return 0.0; /* no bond area, or an infinite force */
    double k = granulation_bond_area(d, c->deformation) /
               granulation_film_force(laws->convention, d, laws->viscosity, c->u0, 2.0 * h0);
    return granulation_critical_diameter(factor, laws->limit_exponent, k, 0.5 * (i->strength + j->strength));
}

static inline granulation_collision granulation_collide(const granulation_laws *laws, const granulation_body *i,
                                                        const granulation_body *j, double speed) {
    granulation_collision c;
    memset(&c, 0, sizeof c);
    c.limit = HUGE_VAL;
    if (!(speed > 0.0 && speed < HUGE_VAL)) return c;
    double m = granulation_reduced(i->mass, j->mass), d = granulation_reduced(i->diameter, j->diameter);
    if (!(m < HUGE_VAL && d < HUGE_VAL)) return c; /* two walls, or NaN */
    double h0 = 0.5 * (i->film + j->film), ha = laws->asperity_factor * laws->grain_diameter;
    double yield = granulation__pair_yield(laws->pair_yield, i->yield, j->yield);
    bool liquid = i->volumes.l > 0.0 || j->volumes.l > 0.0;
    c.u0 = 0.5 * speed;
    c.st_v = granulation_viscous_stokes(laws->convention, m, c.u0, laws->viscosity, d);
    c.st_def = yield > 0.0 ? granulation_deformation_stokes(m, c.u0, d, yield) : yield == 0.0 ? HUGE_VAL : (double)NAN;
    granulation__decide(laws, laws->stiffness == GRANULATION_FIXED_RATIO ? laws->yield_ratio : yield / laws->modulus, d,
                        h0, ha, liquid, &c);
    if (c.coalesces && laws->limit != GRANULATION_NO_LIMIT && i->mass < HUGE_VAL && j->mass < HUGE_VAL &&
        (laws->limit_type_one || c.reason != GRANULATION_TYPE_I)) {
        c.limit = granulation__limit(laws, i, j, d, h0, &c);
        if (!(granulation_diameter(granulation_volume(&i->volumes) + granulation_volume(&j->volumes)) <= c.limit)) {
            c.coalesces = c.both = false;
            c.reason = GRANULATION_REBOUND_SIZE;
            c.u3 = c.u0;
        }
    }
    return c;
}

static inline granulation_reason granulation_classify(const granulation_laws *laws, double st_v, double st_def,
                                                      double yield_ratio, double film_ratio, double width) {
    granulation_collision c;
    memset(&c, 0, sizeof c);
    c.u0 = 1.0;
    c.st_v = st_v;
    c.st_def = st_def;
    granulation__decide(laws, yield_ratio, width, film_ratio, 1.0, true, &c); /* lengths in units of ha */
    return c.reason;
}

static inline bool granulation_breaks(const granulation_laws *laws, const granulation_body *body, double speed) {
    double stress =
        granulation_herschel_bulkley(body->yield, laws->flow_consistency, laws->shear_rate, laws->flow_index);
    return granulation_breakage_stokes(body->mass / granulation_volume(&body->volumes), speed, stress) >
           laws->breakage_stokes;
}

/* ---- random numbers ---- */

static inline uint64_t granulation__rotate(uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }

static inline granulation_random granulation_random_seed(uint64_t seed) {
    granulation_random r;
    for (int i = 0; i < 4; i++) {
        uint64_t z = (seed += UINT64_C(0x9e3779b97f4a7c15));
        z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
        z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
        r.state[i] = z ^ (z >> 31);
    }
    return r;
}
static inline uint64_t granulation_random_bits(granulation_random *r) {
    /* of zeros come zeros only */
    if (!(r->state[0] | r->state[1] | r->state[2] | r->state[3])) *r = granulation_random_seed(0);
    uint64_t *s = r->state, result = granulation__rotate(s[1] * 5, 7) * 9, t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = granulation__rotate(s[3], 45);
    return result;
}
static inline double granulation_random_uniform(granulation_random *r) {
    return (double)(granulation_random_bits(r) >> 11) * (1.0 / 9007199254740992.0);
}
static inline double granulation_random_normal(granulation_random *r) { /* polar method of Marsaglia */
    double u, v, q;
    do {
        u = 2.0 * granulation_random_uniform(r) - 1.0;
        v = 2.0 * granulation_random_uniform(r) - 1.0;
        q = u * u + v * v;
    } while (!(q > 0.0 && q < 1.0));
    return u * sqrt(-2.0 * riddle_log(q) / q);
}

/* ---- ensembles ---- */

static inline granulation_estimate granulation_estimate_of(const double *values, int n, int stride) {
    /* Student 97.5 % for 1 .. 4 degrees of freedom. */
    const double few[5] = {0.0, 12.706204736, 4.302652730, 3.182446305, 2.776445105};
    granulation_estimate e = {(double)NAN, 0.0, 0.0};
    if (!values || n < 1 || stride < 1) return e;
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < n; i++) sum += values[(size_t)i * (size_t)stride];
    e.mean = sum / n;
    if (n == 1) return e;
    for (int i = 0; i < n; i++) {
        double d = values[(size_t)i * (size_t)stride] - e.mean;
        squares += d * d;
    }
    e.deviation = sqrt(squares / (n - 1));
    /* Expansion of Fisher and Cornish (1960), within 3e-3 from 5 on. */
    double z = 1.959963984540054, f = n - 1, student;
    student = z + 2.372271230298562 / f + 2.822498615739611 / (f * f) + 2.555849679507722 / (f * f * f);
    if (n <= 5) student = few[n - 1];
    e.confidence = student * e.deviation / sqrt((double)n);
    return e;
}

static inline granulation_replicate granulation_replicate_of(const granulation_sim *sim) {
    granulation_replicate r;
    const int64_t *n = sim->tally.by_reason;
    double percent = sim->tally.interactions > 0 ? 100.0 / (double)sim->tally.interactions : 0.0;
    r.type1 = percent * (double)n[GRANULATION_TYPE_I];
    r.type2 = percent *
              (double)(n[GRANULATION_TYPE_II_PLASTIC] + n[GRANULATION_TYPE_II_ELASTIC] + n[GRANULATION_TYPE_II_DRY]);
    r.rebound = percent * (double)sim->tally.interactions - r.type1 - r.type2;
    r.both = percent * (double)sim->tally.both;
    r.mean_size = granulation_sim_mean(sim, 4, 3);
    r.interactions = (double)sim->tally.interactions;
    r.breakages = (double)sim->tally.breakages;
    r.granules = sim->n;
    r.d10 = granulation_sim_mean(sim, 1, 0), r.d30 = granulation_sim_mean(sim, 3, 0),
    r.d32 = granulation_sim_mean(sim, 3, 2);
    r.x10 = granulation_sim_percentile(sim, 0.1), r.x50 = granulation_sim_percentile(sim, 0.5);
    r.x90 = granulation_sim_percentile(sim, 0.9);
    r.span = (r.x90 - r.x10) / r.x50;
    return r;
}

/* ---- kernels ---- */
static inline double granulation__rate_of(const void *data) {
    return data ? ((const granulation_kernel_data *)data)->rate : 1.0;
}
static inline double granulation__inner(const granulation_granule *i, const granulation_granule *j,
                                        const granulation_kernel_data *data) {
    return data->inner ? data->inner(i, j, data) : data->rate;
}
static inline bool granulation__beyond(const granulation_granule *i, const granulation_granule *j, double limit) {
    return granulation_diameter(granulation_volume(i) + granulation_volume(j)) > limit;
}
static inline double granulation_constant_kernel(const granulation_granule *i, const granulation_granule *j,
                                                 const void *data) {
    (void)i;
    (void)j;
    return granulation__rate_of(data);
}
static inline double granulation_sum_kernel(const granulation_granule *i, const granulation_granule *j,
                                            const void *data) {
    return granulation__rate_of(data) * (granulation_volume(i) + granulation_volume(j));
}
static inline double granulation_product_kernel(const granulation_granule *i, const granulation_granule *j,
                                                const void *data) {
    return granulation__rate_of(data) * granulation_volume(i) * granulation_volume(j);
}
static inline double granulation_shear_kernel(const granulation_granule *i, const granulation_granule *j,
                                              const void *data) {
    double r = riddle_cbrt(granulation_volume(i)) + riddle_cbrt(granulation_volume(j));
    return granulation__rate_of(data) * (r * r * r);
}
static inline double granulation_eke_kernel(const granulation_granule *i, const granulation_granule *j,
                                            const void *data) {
    double u = granulation_volume(i), v = granulation_volume(j), r = riddle_cbrt(u) + riddle_cbrt(v);
    return granulation__rate_of(data) * (r * r) * sqrt(1.0 / u + 1.0 / v);
}
static inline double granulation_brownian_kernel(const granulation_granule *i, const granulation_granule *j,
                                                 const void *data) {
    double u = riddle_cbrt(granulation_volume(i)), v = riddle_cbrt(granulation_volume(j));
    return granulation__rate_of(data) * (u + v) * (1.0 / u + 1.0 / v);
}
static inline double granulation_kapur_kernel(const granulation_granule *i, const granulation_granule *j,
                                              const void *data) {
    const granulation_kernel_data *k = (const granulation_kernel_data *)data;
    if (!k) return (double)NAN;
    double u = granulation_volume(i), v = granulation_volume(j);
    return k->rate * (riddle_pow(u + v, k->a) / riddle_pow(u * v, k->b));
}
static inline double granulation_collision_kernel(const granulation_granule *i, const granulation_granule *j,
                                                  const void *data) {
    const granulation_kernel_data *k = (const granulation_kernel_data *)data;
    if (!k) return (double)NAN;
    double d = granulation_diameter(granulation_volume(i)) + granulation_diameter(granulation_volume(j));
    return k->rate * (0.25 * RIDDLE_PI) * (d * d) * k->speed;
}
static inline double granulation_cutoff_kernel(const granulation_granule *i, const granulation_granule *j,
                                               const void *data) {
    const granulation_kernel_data *k = (const granulation_kernel_data *)data;
    if (!k) return (double)NAN;
    return granulation__beyond(i, j, k->limit) ? 0.0 : granulation__inner(i, j, k);
}
static inline double granulation_saturation_kernel(const granulation_granule *i, const granulation_granule *j,
                                                   const void *data) {
    const granulation_kernel_data *k = (const granulation_kernel_data *)data;
    if (!(k && k->laws)) return (double)NAN;
    double critical = k->laws->critical_saturation;
    if (!(granulation_saturation(i) >= critical && granulation_saturation(j) >= critical) ||
        granulation__beyond(i, j, k->limit))
        return 0.0;
    return granulation__inner(i, j, k);
}
static inline double granulation_austin_breakage(double z, double mother, const void *data) {
    const granulation_austin *a = (const granulation_austin *)data;
    (void)mother;
    if (!a || !(a->phi >= 0.0 && a->phi <= 1.0 && a->gamma > 0.0 && a->beta > 0.0)) return (double)NAN;
    if (!(z > 0.0)) return z == 0.0 ? 0.0 : (double)NAN;
    return a->phi * riddle_pow(z, a->gamma / 3.0) + (1.0 - a->phi) * riddle_pow(z, a->beta / 3.0);
}
static inline double granulation_class_kernel(const granulation_granule *i, const granulation_granule *j,
                                              const void *data) {
    const granulation_kernel_data *k = (const granulation_kernel_data *)data;
    if (!(k && k->laws && k->speed >= 0.0)) return (double)NAN;
    granulation_body p = granulation_body_of(k->laws, i), q = granulation_body_of(k->laws, j);
    granulation_collision c = granulation_collide(k->laws, &p, &q, k->speed);
    if (!c.coalesces) return 0.0;
    return (c.reason == GRANULATION_TYPE_I || c.reason == GRANULATION_TYPE_II_ELASTIC ? k->a : k->b) *
           granulation__inner(i, j, k);
}

/* Returns the mean granule of a cell; an empty one-component cell has the composition of everything ever added. */
static inline granulation_granule granulation_balance_cell(const granulation_balance *b, int cell) {
    granulation_granule g = {(double)NAN, (double)NAN, (double)NAN};
    if (cell < 0 || cell >= b->n) return g;
    double key = b->pivot[0][cell % b->size[0]], count = b->number[cell], wet = b->total.s + b->total.l;
    double air_share = wet > 0.0 ? (b->total.a - b->air_released) / wet : 0.0;
    if (b->components == 2) {
        g.s = key;
        g.l = b->pivot[1][cell / b->size[0]];
        g.a = count > 0.0 ? b->air[cell] / count : air_share * (g.s + g.l);
    } else {
        g.l = count > 0.0 ? b->liquid[cell] / count : wet > 0.0 ? key * (b->total.l / wet) : 0.0;
        if (!(g.l < key)) g.l = g.l > 0.0 ? key * (1.0 - 1e-9) : 0.0; /* round-off of totals near underflow */
        g.s = key - g.l;
        g.a = count > 0.0 ? b->air[cell] / count : air_share * key;
    }
    return g;
}

#ifdef GRANULATION__BODIES

/* ---- status, memory ---- */
#define GRANULATION__TEXT(name, text)                                                                                  \
    case name: return text;
GRANULATION_API const char *granulation_status_text(granulation_status status) {
    switch (status) {
        GRANULATION_STATUSES(GRANULATION__TEXT)
    default: return "unknown status";
    }
}
GRANULATION_API const char *granulation_reason_text(granulation_reason reason) {
    switch (reason) {
        GRANULATION_REASONS(GRANULATION__TEXT)
    default: return "unknown reason";
    }
}

static inline void *granulation__memory(const granulation_memory *m, void *old, size_t old_size, size_t new_size) {
    if (m->fn) return old || new_size ? m->fn(m->user, old, old_size, new_size) : NULL;
    if (new_size) return realloc(old, new_size);
    free(old);
    return NULL;
}

/* Grows *block from *capacity to at least `needed` elements. Returns false when out of memory. */
static inline bool granulation__grow(const granulation_memory *m, void **block, int *capacity, int64_t needed,
                                     size_t element) {
    if (needed <= *capacity) return true;
    int64_t fresh = *capacity + (int64_t)(*capacity) / 2 + 64;
    if (fresh < needed) fresh = needed;
    if (fresh > INT32_MAX) return false;
    void *p = granulation__memory(m, *block, (size_t)*capacity * element, (size_t)fresh * element);
    if (!p) return false;
    *block = p;
    *capacity = (int)fresh;
    return true;
}

static inline bool granulation__refuse(const char **field, const char *name) {
    if (field) *field = name;
    return true;
}
#define GRANULATION__NEED(condition, name)                                                                             \
    if (!(condition) && granulation__refuse(field, name)) return GRANULATION_BAD_DEF

static inline bool granulation__finite(double x) { return fabs(x) < HUGE_VAL; }

GRANULATION_API granulation_laws granulation_default_laws(void) {
    granulation_laws w;
    memset(&w, 0, sizeof w);
    w.convention = GRANULATION_CONSISTENT;
    w.viscosity = 0.035;
    w.solid_density = 1700.0;
    w.liquid_density = 1000.0;
    w.air_density = 1.2;
    w.surface_tension = 0.048;
    w.contact_angle = 0.0;
    w.grain_diameter = 1e-6;
    w.shape_factor = 6.0;
    w.asperity_factor = 0.1;
    w.poisson = 0.3;
    w.critical_saturation = 0.85;
    w.stiffness = GRANULATION_FIXED_RATIO;
    w.yield_ratio = 0.04;
    w.modulus = 1e7;
    w.pair_yield = GRANULATION_YIELD_MEAN;
    w.limit = GRANULATION_LIMIT_MOISTURE;
    w.limit_diameter = 2.30e-4;
    w.limit_moisture = 33.0 / 52.0;
    w.limit_exponent = 0.5;
    w.breakage_stokes = 0.2;
    w.flow_index = 1.0;
    return w;
}

GRANULATION_API granulation_status granulation_check_laws(const granulation_laws *w, const char **field) {
    if (field) *field = w ? NULL : "laws";
    if (!w) return GRANULATION_BAD_ARGUMENT;
    GRANULATION__NEED(w->convention == GRANULATION_CONSISTENT || w->convention == GRANULATION_PRINTED, "convention");
    GRANULATION__NEED(w->viscosity > 0.0 && granulation__finite(w->viscosity), "viscosity");
    GRANULATION__NEED(w->solid_density > 0.0 && granulation__finite(w->solid_density), "solid_density");
    GRANULATION__NEED(w->liquid_density >= 0.0 && granulation__finite(w->liquid_density), "liquid_density");
    GRANULATION__NEED(w->air_density >= 0.0 && granulation__finite(w->air_density), "air_density");
    GRANULATION__NEED(w->surface_tension >= 0.0 && granulation__finite(w->surface_tension), "surface_tension");
    GRANULATION__NEED(w->contact_angle >= 0.0 && w->contact_angle <= 0.5 * RIDDLE_PI, "contact_angle");
    GRANULATION__NEED(w->grain_diameter > 0.0 && granulation__finite(w->grain_diameter), "grain_diameter");
    GRANULATION__NEED(w->shape_factor > 0.0 && granulation__finite(w->shape_factor), "shape_factor");
    GRANULATION__NEED(w->asperity_factor > 0.0 && granulation__finite(w->asperity_factor), "asperity_factor");
    GRANULATION__NEED(w->poisson >= -1.0 && w->poisson < 0.5, "poisson");
    GRANULATION__NEED(w->critical_saturation > 0.0 && w->critical_saturation <= 1.0, "critical_saturation");
    GRANULATION__NEED(w->stiffness == GRANULATION_FIXED_RATIO || w->stiffness == GRANULATION_FIXED_MODULUS,
                      "stiffness");
    GRANULATION__NEED(w->yield_ratio >= 0.0 && granulation__finite(w->yield_ratio), "yield_ratio");
    GRANULATION__NEED(w->modulus > 0.0, "modulus");
    GRANULATION__NEED(w->pair_yield == GRANULATION_YIELD_MEAN || w->pair_yield == GRANULATION_YIELD_WEAKER,
                      "pair_yield");
    GRANULATION__NEED(w->limit >= GRANULATION_NO_LIMIT && w->limit <= GRANULATION_LIMIT_PRINTED, "limit");
    GRANULATION__NEED(w->limit_diameter > 0.0, "limit_diameter");
    GRANULATION__NEED(w->limit_moisture > 0.0 && granulation__finite(w->limit_moisture), "limit_moisture");
    GRANULATION__NEED(w->limit_exponent > 0.0 && granulation__finite(w->limit_exponent), "limit_exponent");
    GRANULATION__NEED(w->breakage_stokes > 0.0, "breakage_stokes");
    GRANULATION__NEED(w->flow_consistency >= 0.0 && granulation__finite(w->flow_consistency), "flow_consistency");
    GRANULATION__NEED(w->flow_index >= 0.0 && granulation__finite(w->flow_index), "flow_index");
    GRANULATION__NEED(w->shear_rate >= 0.0 && granulation__finite(w->shear_rate), "shear_rate");
    return GRANULATION_OK;
}

/* ==== >>simulation ==== */
#define GRANULATION__COOKIE UINT64_C(0x6772616e756c6531)

GRANULATION_API granulation_def granulation_default_def(void) {
    granulation_def d;
    memset(&d, 0, sizeof d);
    d.laws = granulation_default_laws();
    d.box = 2e-3;
    d.step = 1.0;
    d.dilation = 1e4;
    for (int k = 0; k < 3; k++) {
        d.velocity_mean[k] = 3.0;
        d.velocity_deviation[k] = 1.0;
    }
    d.detection = GRANULATION_SWEPT;
    d.contact = GRANULATION_CONTACT_SUM;
    d.bounce = GRANULATION_CONSERVING;
    d.restitution = 1.0;
    d.approaching_only = true;
    d.consolidation = 0.0425;
    d.breakage = true;
    d.breakage_least_volume = 1e-12;
    d.most_granules = 4000000;
    d.most_events = 1000;
    d.place_attempts = 2000;
    d.seed = 1;
    d.cookie = GRANULATION__COOKIE;
    return d;
}

GRANULATION_API granulation_def granulation_paper_def(void) {
    granulation_def d = granulation_default_def();
    d.detection = GRANULATION_END_OF_STEP;
    d.contact = GRANULATION_CONTACT_LARGER;
    d.bounce = GRANULATION_REVERSAL;
    d.approaching_only = false;
    return d;
}

GRANULATION_API granulation_status granulation_check_def(const granulation_def *d, const char **field) {
    if (field) *field = d ? NULL : "def";
    if (!d) return GRANULATION_BAD_ARGUMENT;
    GRANULATION__NEED(d->cookie == GRANULATION__COOKIE, "cookie");
    granulation_status status = granulation_check_laws(&d->laws, field);
    if (status != GRANULATION_OK) return status;
    GRANULATION__NEED(d->box > 0.0 && granulation__finite(d->box), "box");
    GRANULATION__NEED(d->step > 0.0 && granulation__finite(d->step), "step");
    GRANULATION__NEED(d->dilation > 0.0, "dilation");
    for (int k = 0; k < 3; k++) {
        GRANULATION__NEED(fabs(d->velocity_mean[k]) < 1e100, "velocity_mean");
        GRANULATION__NEED(d->velocity_deviation[k] >= 0.0 && d->velocity_deviation[k] < 1e100, "velocity_deviation");
    }
    GRANULATION__NEED(d->signs >= GRANULATION_SAME_SIGNS && d->signs <= GRANULATION_TWO_STREAMS, "signs");
    GRANULATION__NEED(d->detection == GRANULATION_SWEPT || d->detection == GRANULATION_END_OF_STEP, "detection");
    GRANULATION__NEED(d->contact >= GRANULATION_CONTACT_SUM && d->contact <= GRANULATION_CONTACT_SMALLER, "contact");
    GRANULATION__NEED(d->bounce == GRANULATION_CONSERVING || d->bounce == GRANULATION_REVERSAL, "bounce");
    GRANULATION__NEED(d->restitution >= 0.0 && d->restitution <= 1.0, "restitution");
    GRANULATION__NEED(d->stirring >= 0.0 && granulation__finite(d->stirring), "stirring");
    GRANULATION__NEED(d->consolidation >= 0.0 && granulation__finite(d->consolidation), "consolidation");
    GRANULATION__NEED(d->breakage_least_volume >= 0.0, "breakage_least_volume");
    GRANULATION__NEED(d->breakage_rest >= 0, "breakage_rest");
    GRANULATION__NEED(d->most_granules >= 1, "most_granules");
    GRANULATION__NEED(d->most_events >= 1 && d->most_events <= 1000000000, "most_events");
    GRANULATION__NEED(d->place_attempts >= 1, "place_attempts");
    return GRANULATION_OK;
}

/* One granule as the search for contacts sees it, in the order of cells */
typedef struct granulation__item {
    double x, y, z, vx, vy, vz, radius;
    int id;
} granulation__item;

/* Within a sweep: the path time to which the position belongs, the sum of its jumps away from its item, the item, how
   often the path has changed, and whether the granule is gone */
typedef struct granulation__motion {
    double time, jump;
    int item;
    int stamp;
    int gone;
} granulation__motion;

typedef struct granulation__hit {
    double time;
    int i, j, stamp_i, stamp_j;
} granulation__hit;

GRANULATION_API granulation_status granulation_sim_init(granulation_sim *sim, const granulation_def *def) {
    if (!sim) return GRANULATION_BAD_ARGUMENT;
    memset(sim, 0, sizeof *sim);
    granulation_status status = granulation_check_def(def, NULL);
    if (status != GRANULATION_OK) return status;
    sim->def = *def;
    sim->random = granulation_random_seed(def->seed);
    return GRANULATION_OK;
}

GRANULATION_API void granulation_sim_free(granulation_sim *sim) {
    if (!sim) return;
    const granulation_memory *m = &sim->def.memory;
    size_t n = (size_t)sim->capacity, cells = (size_t)sim->cells;
    double *arrays[6] = {sim->x, sim->y, sim->z, sim->vx, sim->vy, sim->vz};
    for (int k = 0; k < 6; k++) granulation__memory(m, arrays[k], arrays[k] ? n * sizeof(double) : 0, 0);
    granulation__memory(m, sim->body, sim->body ? n * sizeof(granulation_body) : 0, 0);
    granulation__memory(m, sim->broken, sim->broken ? n * sizeof(int64_t) : 0, 0);
    granulation__memory(m, sim->motion, sim->motion ? n * sizeof(granulation__motion) : 0, 0);
    granulation__memory(m, sim->cell_start, cells * sizeof(int), 0);
    granulation__memory(m, sim->items, (size_t)sim->item_capacity * sizeof(granulation__item), 0);
    granulation__memory(m, sim->heap, (size_t)sim->event_capacity * sizeof(granulation__hit), 0);
    granulation__memory(m, sim->hits, (size_t)sim->hit_capacity * sizeof(int), 0);
    memset(sim, 0, sizeof *sim);
}

/* Grows all arrays of granules together. All new blocks are allocated first, so that a failure leaves
   everything as it was. */
static inline granulation_status granulation__reserve(granulation_sim *sim, int64_t needed) {
    if (needed <= sim->capacity) return GRANULATION_OK;
    int64_t fresh = sim->capacity + (int64_t)sim->capacity / 2 + 64;
    if (fresh < needed) fresh = needed;
    if (fresh > INT32_MAX) return GRANULATION_NO_MEMORY;
    void *blocks[9] = {sim->x, sim->y, sim->z, sim->vx, sim->vy, sim->vz, sim->body, sim->broken, sim->motion};
    void *made[9];
    size_t size[9], old = (size_t)sim->capacity;
    for (int k = 0; k < 9; k++) {
        size[k] = k < 6    ? sizeof(double)
                  : k == 6 ? sizeof(granulation_body)
                  : k == 7 ? sizeof(int64_t)
                           : sizeof(granulation__motion);
        made[k] = granulation__memory(&sim->def.memory, NULL, 0, (size_t)fresh * size[k]);
        if (made[k]) continue;
        while (k-- > 0) granulation__memory(&sim->def.memory, made[k], (size_t)fresh * size[k], 0);
        return GRANULATION_NO_MEMORY;
    }
    for (int k = 0; k < 9; k++) {
        if (old) memcpy(made[k], blocks[k], (size_t)sim->n * size[k]);
        granulation__memory(&sim->def.memory, blocks[k], old * size[k], 0);
    }
    sim->x = (double *)made[0];
    sim->y = (double *)made[1];
    sim->z = (double *)made[2];
    sim->vx = (double *)made[3];
    sim->vy = (double *)made[4];
    sim->vz = (double *)made[5];
    sim->body = (granulation_body *)made[6];
    sim->broken = (int64_t *)made[7];
    sim->motion = made[8];
    sim->capacity = (int)fresh;
    return GRANULATION_OK;
}

static inline double granulation__wrap(double x, double box) {
    if (x >= 0.0 && x < box) return x;
    x -= box * floor(x / box);
    return x >= 0.0 && x < box ? x : 0.0; /* -1e-30 + box rounds to box */
}
/* Returns the nearest image of a difference of two places in the box, |dx| < 1.5 box. */
static inline double granulation__nearest(double dx, double box) {
    if (dx > 0.5 * box) return dx - box;
    if (dx < -0.5 * box) return dx + box;
    return dx;
}
static inline double granulation__reach(granulation_contact contact, double a, double b) {
    if (contact == GRANULATION_CONTACT_SUM) return a + b;
    return contact == GRANULATION_CONTACT_LARGER ? (a > b ? a : b) : (a < b ? a : b);
}
static inline void granulation__draw_velocity(granulation_sim *sim, double velocity[3]) {
    const granulation_def *def = &sim->def;
    bool back = def->signs == GRANULATION_TWO_STREAMS && granulation_random_bits(&sim->random) >> 63;
    for (int k = 0; k < 3; k++) {
        if (def->signs == GRANULATION_RANDOM_SIGNS) back = granulation_random_bits(&sim->random) >> 63;
        velocity[k] = (back ? -1.0 : 1.0) * def->velocity_mean[k] +
                      def->velocity_deviation[k] * granulation_random_normal(&sim->random);
    }
}
static inline void granulation__note_momentum(granulation_sim *sim, int i, double mass, double sign) {
    sim->ledger.momentum[0] += sign * mass * sim->vx[i];
    sim->ledger.momentum[1] += sign * mass * sim->vy[i];
    sim->ledger.momentum[2] += sign * mass * sim->vz[i];
}

GRANULATION_API granulation_status granulation_sim_put(granulation_sim *sim, const granulation_granule *g,
                                                       const double centre[3], const double velocity[3]) {
    if (!sim || !g || !centre || !velocity || !(sim->def.box > 0.0) || !granulation__is_granule(g))
        return GRANULATION_BAD_ARGUMENT;
    for (int k = 0; k < 3; k++)
        if (!(fabs(centre[k]) < 1e100 && fabs(velocity[k]) < 1e100)) return GRANULATION_BAD_ARGUMENT;
    granulation_body body = granulation_body_of(&sim->def.laws, g);
    if (!(body.diameter < 0.5 * sim->def.box)) return GRANULATION_TOO_LARGE;
    if (!(body.diameter > 0.0 && body.mass > 0.0)) return GRANULATION_BAD_ARGUMENT; /* underflow */
    granulation_status status = granulation__reserve(sim, (int64_t)sim->n + 1);
    if (status != GRANULATION_OK) return status;
    int i = sim->n++;
    sim->x[i] = granulation__wrap(centre[0], sim->def.box);
    sim->y[i] = granulation__wrap(centre[1], sim->def.box);
    sim->z[i] = granulation__wrap(centre[2], sim->def.box);
    sim->vx[i] = velocity[0];
    sim->vy[i] = velocity[1];
    sim->vz[i] = velocity[2];
    sim->body[i] = body;
    sim->broken[i] = -1;
    sim->ledger.solid += g->s;
    sim->ledger.liquid += g->l;
    sim->ledger.air += g->a;
    granulation__note_momentum(sim, i, body.mass, 1.0);
    return GRANULATION_OK;
}

/* ---- cells: a counting sort of the granules, and a walk over those near a place ---- */

typedef struct granulation__span {
    int lo, count;
} granulation__span;

/* Returns the cells along an axis within `reach` of a centre, 0 <= centre < box; all cells once where the reach extends
   around the box. */
static inline granulation__span granulation__span_of(double centre, double reach, double per_cell, int cells) {
    granulation__span s = {0, cells};
    if (!(2.0 * reach * per_cell + 2.0 < cells)) return s;
    /* Shifted: truncation is floor. */
    int lo = (int)((centre - reach) * per_cell + cells), hi = (int)((centre + reach) * per_cell + cells);
    s.count = hi - lo + 1;
    s.lo = lo < cells ? lo : lo < 2 * cells ? lo - cells : 0;
    return s;
}

typedef struct granulation__walk {
    const int *start;
    int cells, iy, iz, part;
    granulation__span x, y, z;
    int from, to; /* items of the present run */
} granulation__walk;

static inline granulation__walk granulation__near(const granulation_sim *sim, int cells, double x, double y, double z,
                                                  double reach) {
    granulation__walk w;
    double per_cell = cells / sim->def.box;
    w.start = sim->cell_start;
    w.cells = cells;
    w.x = granulation__span_of(x, reach, per_cell, cells);
    w.y = granulation__span_of(y, reach, per_cell, cells);
    w.z = granulation__span_of(z, reach, per_cell, cells);
    w.iy = w.iz = w.part = 0;
    w.from = w.to = 0;
    return w;
}
/* Sets w to the next run of items: a row of cells along x, in two parts where it wraps around. Returns
   false at the end. */
static inline bool granulation__next(granulation__walk *w) {
    while (w->iz < w->z.count) {
        int iz = w->z.lo + w->iz, iy = w->y.lo + w->iy;
        iz = iz >= w->cells ? iz - w->cells : iz;
        iy = iy >= w->cells ? iy - w->cells : iy;
        int row = (iz * w->cells + iy) * w->cells, end = w->x.lo + w->x.count;
        if (w->part == 0) {
            w->from = w->start[row + w->x.lo];
            w->to = w->start[row + (end < w->cells ? end : w->cells)];
            w->part = end > w->cells;
        } else {
            w->from = w->start[row];
            w->to = w->start[row + end - w->cells];
            w->part = 0;
        }
        if (!w->part && ++w->iy == w->y.count) {
            w->iy = 0;
            w->iz++;
        }
        if (w->from < w->to) return true;
    }
    return false;
}

static inline int granulation__cells_for(int n) {
    int cells = (int)riddle_cbrt((double)n);
    return cells < 1 ? 1 : cells > 512 ? 512 : cells;
}

/* Returns the cell of a place in the box along one axis. Rounding may give the box's length, which is in
   the last cell. */
static inline int granulation__cell_of(double x, double box, int cells) {
    int cell = (int)(x * (cells / box));
    return cell < cells ? cell : cells - 1;
}

/* Fills cell_start and items; positions must lie in the box */
static inline bool granulation__sort(granulation_sim *sim, int *cells_used) {
    int n = sim->n, cells = granulation__cells_for(n), total = cells * cells * cells;
    void *start = sim->cell_start;
    if (!granulation__grow(&sim->def.memory, &start, &sim->cells, (int64_t)total + 1, sizeof(int))) return false;
    sim->cell_start = (int *)start;
    if (!granulation__grow(&sim->def.memory, &sim->items, &sim->item_capacity, n, sizeof(granulation__item)))
        return false;
    if (!granulation__grow(&sim->def.memory, &sim->hits, &sim->hit_capacity, n, sizeof(int))) return false;
    int *first = sim->cell_start, *cell = (int *)sim->hits;
    granulation__item *items = (granulation__item *)sim->items;
    double box = sim->def.box;
    memset(first, 0, ((size_t)total + 1) * sizeof(int));
    for (int i = 0; i < n; i++) {
        int cx = granulation__cell_of(sim->x[i], box, cells), cy = granulation__cell_of(sim->y[i], box, cells),
            cz = granulation__cell_of(sim->z[i], box, cells);
        cell[i] = (cz * cells + cy) * cells + cx;
        first[cell[i] + 1]++;
    }
    for (int c = 0; c < total; c++) first[c + 1] += first[c];
    /* Backwards: equal cells keep the order of the indices once the counts have run down. */
    for (int i = n - 1; i >= 0; i--) {
        granulation__item *it = items + --first[cell[i] + 1];
        it->x = sim->x[i];
        it->y = sim->y[i];
        it->z = sim->z[i];
        it->vx = sim->vx[i];
        it->vy = sim->vy[i];
        it->vz = sim->vz[i];
        it->radius = 0.5 * sim->body[i].diameter;
        it->id = i;
    }
    /* each first[c + 1] has run down to the start of cell c: shift back */
    for (int c = 0; c < total; c++) first[c] = first[c + 1];
    first[total] = n;
    *cells_used = cells;
    return true;
}

/* ---- placement ---- */

/* Chains of granules by cell. Cells are no smaller than the largest diameter, so that 27 of them hold every neighbour;
   fewer than 3 an axis become one. */
typedef struct granulation__chains {
    int cells, *head, *next; /* cells along an axis; first granule of a cell, next granule of a chain, or -1 */
} granulation__chains;

static inline granulation_status granulation__make_chains(granulation_sim *sim, int64_t all, double largest,
                                                          granulation__chains *chains) {
    double most = floor(sim->def.box / largest);
    int cells = granulation__cells_for((int)all);
    if (most < cells) cells = (int)most;
    if (cells < 3) cells = 1;
    int total = cells * cells * cells;
    void *block = sim->cell_start;
    if (!granulation__grow(&sim->def.memory, &block, &sim->cells, total, sizeof(int))) return GRANULATION_NO_MEMORY;
    sim->cell_start = (int *)block;
    if (!granulation__grow(&sim->def.memory, &sim->hits, &sim->hit_capacity, all, sizeof(int)))
        return GRANULATION_NO_MEMORY;
    chains->cells = cells;
    chains->head = sim->cell_start;
    chains->next = (int *)sim->hits;
    for (int c = 0; c < total; c++) chains->head[c] = -1;
    return GRANULATION_OK;
}

/* Puts granule i into the chain of its cell. */
static inline void granulation__link(const granulation_sim *sim, const granulation__chains *chains, int i) {
    double box = sim->def.box;
    int cells = chains->cells, x = granulation__cell_of(sim->x[i], box, cells),
        y = granulation__cell_of(sim->y[i], box, cells), z = granulation__cell_of(sim->z[i], box, cells),
        c = (z * cells + y) * cells + x;
    chains->next[i] = chains->head[c];
    chains->head[c] = i;
}

/* Returns whether a sphere at a centre within the box overlaps no granule of the chains. */
static inline bool granulation__is_free(const granulation_sim *sim, const granulation__chains *chains,
                                        const double *centre, double diameter) {
    double box = sim->def.box;
    int cells = chains->cells, at[3], width = cells < 3 ? 1 : 27;
    for (int k = 0; k < 3; k++) at[k] = granulation__cell_of(centre[k], box, cells);
    for (int c = 0; c < width; c++) {
        int cx = (at[0] + c % 3 - 1 + cells) % cells, cy = (at[1] + c / 3 % 3 - 1 + cells) % cells,
            cz = (at[2] + c / 9 - 1 + cells) % cells;
        for (int j = chains->head[(cz * cells + cy) * cells + cx]; j >= 0; j = chains->next[j]) {
            double dx = granulation__nearest(sim->x[j] - centre[0], box),
                   dy = granulation__nearest(sim->y[j] - centre[1], box),
                   dz = granulation__nearest(sim->z[j] - centre[2], box),
                   touch = 0.5 * (diameter + sim->body[j].diameter);
            if (!(dx * dx + dy * dy + dz * dz > touch * touch)) return false;
        }
    }
    return true;
}

/* Puts one granule at a random place without overlap, with a velocity of the distribution. */
static inline granulation_status granulation__place_one(granulation_sim *sim, const granulation__chains *chains,
                                                        const granulation_granule *g) {
    double centre[3], velocity[3], diameter = granulation_diameter(granulation_volume(g));
    for (int attempt = 0; attempt < sim->def.place_attempts; attempt++) {
        for (int k = 0; k < 3; k++) centre[k] = sim->def.box * granulation_random_uniform(&sim->random);
        if (!granulation__is_free(sim, chains, centre, diameter)) continue;
        granulation__draw_velocity(sim, velocity);
        return granulation_sim_put(sim, g, centre, velocity);
    }
    return GRANULATION_NO_ROOM;
}

/* Places n granules, all like the first one if `same`. */
static inline granulation_status granulation__place(granulation_sim *sim, const granulation_granule *granules, int n,
                                                    bool same) {
    if (!sim || !granules || n < 0 || !(sim->def.box > 0.0)) return GRANULATION_BAD_ARGUMENT;
    double largest = 0.0;
    for (int i = 0; i < (same ? 1 : n); i++) {
        if (!granulation__is_granule(granules + i)) return GRANULATION_BAD_ARGUMENT;
        double d = granulation_diameter(granulation_volume(granules + i));
        if (!(d < 0.5 * sim->def.box)) return GRANULATION_TOO_LARGE;
        if (d > largest) largest = d;
    }
    for (int i = 0; i < sim->n; i++) largest = sim->body[i].diameter > largest ? sim->body[i].diameter : largest;
    if (n == 0) return GRANULATION_OK;
    granulation__chains chains;
    int64_t all = (int64_t)sim->n + n;
    granulation_status status = granulation__reserve(sim, all);
    if (status == GRANULATION_OK) status = granulation__make_chains(sim, all, largest, &chains);
    if (status != GRANULATION_OK) return status;
    for (int i = 0; i < sim->n; i++) granulation__link(sim, &chains, i);
    for (int i = 0; i < n; i++) {
        status = granulation__place_one(sim, &chains, granules + (same ? 0 : i));
        if (status != GRANULATION_OK) return status;
        granulation__link(sim, &chains, sim->n - 1);
    }
    return GRANULATION_OK;
}

GRANULATION_API granulation_status granulation_sim_add(granulation_sim *sim, const granulation_granule *g, int count) {
    return granulation__place(sim, g, count, true);
}
GRANULATION_API granulation_status granulation_sim_add_many(granulation_sim *sim, const granulation_granule *granules,
                                                            int n) {
    return granulation__place(sim, granules, n, false);
}

/* ---- a heap of contacts: earliest first, then by index, so that the order never depends on how they
   were found ---- */

static inline bool granulation__before(const granulation__hit *a, const granulation__hit *b) {
    if (a->time != b->time) return a->time < b->time;
    return a->i != b->i ? a->i < b->i : a->j < b->j;
}
static inline bool granulation__push(granulation_sim *sim, granulation__hit hit) {
    if (!granulation__grow(&sim->def.memory, &sim->heap, &sim->event_capacity, sim->events + 1,
                           sizeof(granulation__hit)))
        return false;
    granulation__hit *heap = (granulation__hit *)sim->heap;
    int64_t k = sim->events++;
    for (; k > 0 && granulation__before(&hit, heap + (k - 1) / 2); k = (k - 1) / 2) heap[k] = heap[(k - 1) / 2];
    heap[k] = hit;
    return true;
}
static inline granulation__hit granulation__pop(granulation_sim *sim) {
    granulation__hit *heap = (granulation__hit *)sim->heap, top = heap[0], last = heap[--sim->events];
    int64_t k = 0, child;
    while ((child = 2 * k + 1) < sim->events) {
        if (child + 1 < sim->events && granulation__before(heap + child + 1, heap + child)) child++;
        if (!granulation__before(heap + child, &last)) break;
        heap[k] = heap[child];
        k = child;
    }
    heap[k] = last;
    return top;
}

/* Returns the time from now to the contact of two spheres whose difference of places, dx, changes with dv; negative if
   there is none. Overlapping pairs that approach meet now. An approach at less than 1e-12 rad to the tangent does not
   count: after a contact the velocities are parallel to it up to round-off. */
static inline double granulation__contact_time(double dx, double dy, double dz, double dvx, double dvy, double dvz,
                                               double touch) {
    double b = dx * dvx + dy * dvy + dz * dvz;
    if (!(b < 0.0)) return -1.0;
    double distance2 = dx * dx + dy * dy + dz * dz, speed2 = dvx * dvx + dvy * dvy + dvz * dvz;
    if (b * b <= 1e-24 * distance2 * speed2) return -1.0;
    double c = distance2 - touch * touch;
    if (c <= 0.0) return 0.0;
    double root = b * b - speed2 * c;
    if (root < 0.0) return -1.0;
    return c / (sqrt(root) - b);
}

/* ---- what a collision does to its two granules ---- */

static inline void granulation__merge(granulation_sim *sim, int i, int j) {
    granulation_body *p = sim->body + i, *q = sim->body + j;
    double box = sim->def.box, mass = p->mass + q->mass, share = q->mass / mass;
    double dvx = sim->vx[j] - sim->vx[i], dvy = sim->vy[j] - sim->vy[i], dvz = sim->vz[j] - sim->vz[i];
    sim->tally.kinetic_loss += 0.5 * p->mass * share * (dvx * dvx + dvy * dvy + dvz * dvz);
    sim->x[i] = granulation__wrap(sim->x[i] + share * granulation__nearest(sim->x[j] - sim->x[i], box), box);
    sim->y[i] = granulation__wrap(sim->y[i] + share * granulation__nearest(sim->y[j] - sim->y[i], box), box);
    sim->z[i] = granulation__wrap(sim->z[i] + share * granulation__nearest(sim->z[j] - sim->z[i], box), box);
    sim->vx[i] = (p->mass * sim->vx[i] + q->mass * sim->vx[j]) / mass;
    sim->vy[i] = (p->mass * sim->vy[i] + q->mass * sim->vy[j]) / mass;
    sim->vz[i] = (p->mass * sim->vz[i] + q->mass * sim->vz[j]) / mass;
    granulation_granule sum = granulation_sum(&p->volumes, &q->volumes);
    *p = granulation_body_of(&sim->def.laws, &sum);
    if (sim->broken[j] > sim->broken[i]) sim->broken[i] = sim->broken[j];
    ((granulation__motion *)sim->motion)[j].gone = 1;
}

static inline void granulation__bounce(granulation_sim *sim, int i, int j, double dx, double dy, double dz,
                                       const granulation_collision *c) {
    double mi = sim->body[i].mass, mj = sim->body[j].mass;
    if (sim->def.bounce == GRANULATION_REVERSAL) {
        const double defect[3] = {-2.0 * (mi * sim->vx[i] + mj * sim->vx[j]),
                                  -2.0 * (mi * sim->vy[i] + mj * sim->vy[j]),
                                  -2.0 * (mi * sim->vz[i] + mj * sim->vz[j])};
        for (int k = 0; k < 3; k++) {
            sim->ledger.momentum[k] += defect[k];
            sim->ledger.reversal_defect[k] += defect[k];
        }
        sim->vx[i] = -sim->vx[i];
        sim->vy[i] = -sim->vy[i];
        sim->vz[i] = -sim->vz[i];
        sim->vx[j] = -sim->vx[j];
        sim->vy[j] = -sim->vy[j];
        sim->vz[j] = -sim->vz[j];
        return;
    }
    double e = sim->def.restitution;
    if (sim->def.restitution_of_law) {
        e = c->u3 / c->u0;
        e = e > 0.0 ? (e < 1.0 ? e : 1.0) : 0.0;
    }
    double distance2 = dx * dx + dy * dy + dz * dz, reduced = mi * (mj / (mi + mj));
    if (!(distance2 > 0.0)) return; /* two centres in one place have no line of centres */
    double along = dx * (sim->vx[i] - sim->vx[j]) + dy * (sim->vy[i] - sim->vy[j]) + dz * (sim->vz[i] - sim->vz[j]);
    double impulse = -(1.0 + e) * reduced * along / distance2; /* times dx: on i; dx points from j to i */
    sim->tally.kinetic_loss += 0.5 * reduced * (1.0 - e * e) * along * along / distance2;
    sim->vx[i] += impulse / mi * dx;
    sim->vy[i] += impulse / mi * dy;
    sim->vz[i] += impulse / mi * dz;
    sim->vx[j] -= impulse / mj * dx;
    sim->vy[j] -= impulse / mj * dy;
    sim->vz[j] -= impulse / mj * dz;
}

/* Makes i and j meet; both positions are at the present time. Returns true if they have become one granule. */
static inline bool granulation__meet(granulation_sim *sim, int i, int j, double time) {
    granulation_event event;
    double box = sim->def.box, dvx = sim->vx[i] - sim->vx[j], dvy = sim->vy[i] - sim->vy[j],
           dvz = sim->vz[i] - sim->vz[j];
    event.time = time;
    event.i = i;
    event.j = j;
    event.speed = sqrt(dvx * dvx + dvy * dvy + dvz * dvz);
    event.diameter_i = sim->body[i].diameter;
    event.diameter_j = sim->body[j].diameter;
    event.collision = granulation_collide(&sim->def.laws, sim->body + i, sim->body + j, event.speed);
    if (event.collision.reason == GRANULATION_NONE) return false;
    sim->tally.interactions++;
    sim->tally.by_reason[event.collision.reason]++;
    sim->tally.both += event.collision.both;
    if (event.collision.coalesces) granulation__merge(sim, i, j);
    else
        granulation__bounce(sim, i, j, granulation__nearest(sim->x[i] - sim->x[j], box),
                            granulation__nearest(sim->y[i] - sim->y[j], box),
                            granulation__nearest(sim->z[i] - sim->z[j], box), &event.collision);
    if (sim->def.on_collision) sim->def.on_collision(sim->def.collision_user, &event);
    return event.collision.coalesces;
}

static inline void granulation__compact(granulation_sim *sim) {
    const granulation__motion *motion = (const granulation__motion *)sim->motion;
    int k = 0;
    for (int i = 0; i < sim->n; i++) {
        if (motion[i].gone) continue;
        if (k < i) {
            sim->x[k] = sim->x[i];
            sim->y[k] = sim->y[i];
            sim->z[k] = sim->z[i];
            sim->vx[k] = sim->vx[i];
            sim->vy[k] = sim->vy[i];
            sim->vz[k] = sim->vz[i];
            sim->body[k] = sim->body[i];
            sim->broken[k] = sim->broken[i];
        }
        k++;
    }
    sim->n = k;
}

static inline void granulation__move(granulation_sim *sim, double path_time) {
    double box = sim->def.box;
    for (int i = 0; i < sim->n; i++) {
        sim->x[i] = granulation__wrap(sim->x[i] + path_time * sim->vx[i], box);
        sim->y[i] = granulation__wrap(sim->y[i] + path_time * sim->vy[i], box);
        sim->z[i] = granulation__wrap(sim->z[i] + path_time * sim->vz[i], box);
    }
}

/* ---- the paper's rule: overlaps at the end of a step, by index, one event a granule ---- */

static inline granulation_status granulation__end_of_step(granulation_sim *sim, double begun, double *to_go) {
    int cells;
    granulation__move(sim, *to_go);
    *to_go = 0.0;
    if (!granulation__sort(sim, &cells)) return GRANULATION_NO_MEMORY;
    const granulation__item *items = (const granulation__item *)sim->items;
    granulation__motion *motion = (granulation__motion *)sim->motion;
    granulation_contact contact = sim->def.contact;
    double box = sim->def.box, widest = 0.0;
    for (int i = 0; i < sim->n; i++) {
        widest = items[i].radius > widest ? items[i].radius : widest;
        motion[i].gone = motion[i].stamp = 0;
    }
    sim->events = 0;
    for (int a = 0; a < sim->n; a++) {
        const granulation__item p = items[a];
        granulation__walk walk =
            granulation__near(sim, cells, p.x, p.y, p.z, granulation__reach(contact, p.radius, widest));
        while (granulation__next(&walk))
            for (int b = walk.from > a ? walk.from : a + 1; b < walk.to; b++) {
                const granulation__item *q = items + b;
                double dx = granulation__nearest(p.x - q->x, box), dy = granulation__nearest(p.y - q->y, box),
                       dz = granulation__nearest(p.z - q->z, box);
                double touch = granulation__reach(contact, p.radius, q->radius);
                if (!(dx * dx + dy * dy + dz * dz < touch * touch)) continue;
                if (sim->def.approaching_only &&
                    !(dx * (p.vx - q->vx) + dy * (p.vy - q->vy) + dz * (p.vz - q->vz) < 0.0))
                    continue;
                granulation__hit hit = {0.0, p.id < q->id ? p.id : q->id, p.id < q->id ? q->id : p.id, 0, 0};
                if (!granulation__push(sim, hit)) return GRANULATION_NO_MEMORY;
            }
    }
    double now = begun + sim->def.step;
    while (sim->events > 0) {
        granulation__hit hit = granulation__pop(sim);
        if (motion[hit.i].stamp || motion[hit.j].stamp) continue;
        motion[hit.i].stamp = motion[hit.j].stamp = 1;
        granulation__meet(sim, hit.i, hit.j, now);
    }
    granulation__compact(sim);
    return GRANULATION_OK;
}

/* ---- swept: every contact in the order of time ----
   A step is cut into sweeps so short that a granule meets only those in the cells around it. Within a sweep each
   granule keeps the place of its last event; `fastest` bounds the speed of all relative to the mean, `shift` how far
   any was pushed or moved to a centre of mass, so that a search finds every granule whose place in the cells is
   out of date. */

/* Most contacts of a granule in one sweep; after these it meets no other until the next sweep. The paper's reversal can
   lock three touching granules in an endless exchange of signs; ordinary granules have two contacts at most. */
#define GRANULATION__LOCKED 8

typedef struct granulation__sweep {
    int cells;
    double end;     /* [s] of path */
    double mean[3]; /* velocity of the frame of the cells [m/s] */
    double fastest, widest, shift;
    double allowed; /* of fastest [m/s]: beyond it a search would reach the next image */
    double spacing; /* [m] mean distance of granules */
} granulation__sweep;

static inline double granulation__frame_speed(const granulation_sim *sim, const granulation__sweep *w, int i) {
    double x = sim->vx[i] - w->mean[0], y = sim->vy[i] - w->mean[1], z = sim->vz[i] - w->mean[2];
    return sqrt(x * x + y * y + z * z);
}

/* Adds every contact of i within the rest of the sweep to the heap; the place of i is that at `now`. Also
   raises the bounds. */
static inline bool granulation__predict(granulation_sim *sim, granulation__sweep *w, int i, double now) {
    const granulation__motion *motion = (const granulation__motion *)sim->motion;
    const granulation__item *items = (const granulation__item *)sim->items;
    double box = sim->def.box, radius = 0.5 * sim->body[i].diameter, speed = granulation__frame_speed(sim, w, i),
           left = w->end - now;
    double x = sim->x[i], y = sim->y[i], z = sim->z[i];
    double reach =
        granulation__reach(sim->def.contact, radius, w->widest) + speed * left + w->fastest * w->end + w->shift;
    reach *= 1.0 + 1e-12;
    granulation__walk walk = granulation__near(sim, w->cells, granulation__wrap(x - w->mean[0] * now, box),
                                               granulation__wrap(y - w->mean[1] * now, box),
                                               granulation__wrap(z - w->mean[2] * now, box), reach);
    while (granulation__next(&walk))
        for (int b = walk.from; b < walk.to; b++) {
            int j = items[b].id;
            if (j == i || motion[j].gone) continue;
            double late = now - motion[j].time;
            double dx = granulation__nearest(x - granulation__wrap(sim->x[j] + late * sim->vx[j], box), box);
            double dy = granulation__nearest(y - granulation__wrap(sim->y[j] + late * sim->vy[j], box), box);
            double dz = granulation__nearest(z - granulation__wrap(sim->z[j] + late * sim->vz[j], box), box);
            double t = granulation__contact_time(
                dx, dy, dz, sim->vx[i] - sim->vx[j], sim->vy[i] - sim->vy[j], sim->vz[i] - sim->vz[j],
                granulation__reach(sim->def.contact, radius, 0.5 * sim->body[j].diameter));
            if (!(t >= 0.0 && t <= left)) continue;
            int a = i < j ? i : j, c = i < j ? j : i;
            granulation__hit hit = {now + t, a, c, motion[a].stamp, motion[c].stamp};
            if (!granulation__push(sim, hit)) return false;
        }
    return true;
}

/* Moves i to its place at `now`, inside the box. */
static inline void granulation__bring(granulation_sim *sim, int i, double now) {
    granulation__motion *m = (granulation__motion *)sim->motion + i;
    double t = now - m->time, box = sim->def.box;
    sim->x[i] = granulation__wrap(sim->x[i] + t * sim->vx[i], box);
    sim->y[i] = granulation__wrap(sim->y[i] + t * sim->vy[i], box);
    sim->z[i] = granulation__wrap(sim->z[i] + t * sim->vz[i], box);
    m->time = now;
}

static inline void granulation__jump(granulation_sim *sim, granulation__sweep *w, int i, double distance) {
    granulation__motion *m = (granulation__motion *)sim->motion + i;
    m->jump += distance;
    w->shift = m->jump > w->shift ? m->jump : w->shift;
}

/* Makes room for a granule that has grown: pushes the granules that it now overlaps along the line of centres until
   they touch it; these push others in turn. Gives up after 64 pushes; any overlap left can only shrink. */
static inline bool granulation__make_room(granulation_sim *sim, granulation__sweep *w, int first, double now) {
    granulation__motion *motion = (granulation__motion *)sim->motion;
    const granulation__item *items = (const granulation__item *)sim->items;
    double box = sim->def.box;
    int queue[65], length = 1;
    queue[0] = first;
    for (int k = 0; k < length; k++) {
        int i = queue[k];
        double radius = 0.5 * sim->body[i].diameter;
        double reach = granulation__reach(sim->def.contact, radius, w->widest) + w->fastest * w->end + w->shift;
        granulation__walk walk =
            granulation__near(sim, w->cells, granulation__wrap(sim->x[i] - w->mean[0] * now, box),
                              granulation__wrap(sim->y[i] - w->mean[1] * now, box),
                              granulation__wrap(sim->z[i] - w->mean[2] * now, box), reach * (1.0 + 1e-12));
        while (granulation__next(&walk))
            for (int b = walk.from; b < walk.to && length < 65; b++) {
                int j = items[b].id;
                if (j == i || motion[j].gone) continue;
                double late = now - motion[j].time;
                double dx =
                    granulation__nearest(granulation__wrap(sim->x[j] + late * sim->vx[j], box) - sim->x[i], box);
                double dy =
                    granulation__nearest(granulation__wrap(sim->y[j] + late * sim->vy[j], box) - sim->y[i], box);
                double dz =
                    granulation__nearest(granulation__wrap(sim->z[j] + late * sim->vz[j], box) - sim->z[i], box);
                double touch = granulation__reach(sim->def.contact, radius, 0.5 * sim->body[j].diameter);
                double distance2 = dx * dx + dy * dy + dz * dz;
                if (!(distance2 < touch * touch) || !(distance2 > 0.0)) continue;
                double push = touch * (1.0 + 1e-14) / sqrt(distance2) - 1.0;
                granulation__bring(sim, j, now);
                sim->x[j] = granulation__wrap(sim->x[j] + push * dx, box);
                sim->y[j] = granulation__wrap(sim->y[j] + push * dy, box);
                sim->z[j] = granulation__wrap(sim->z[j] + push * dz, box);
                granulation__jump(sim, w, j, push * sqrt(distance2));
                motion[j].stamp++;
                queue[length++] = j;
            }
    }
    for (int k = 1; k < length; k++)
        if (!granulation__predict(sim, w, queue[k], now)) return false;
    return true;
}

/* Bounds of the granules as they stand, and how long the next sweep may be: longest at most */
static inline granulation_status granulation__begin_sweep(granulation_sim *sim, granulation__sweep *w, double longest) {
    granulation__motion *motion = (granulation__motion *)sim->motion;
    int n = sim->n;
    double box = sim->def.box, count = n > 0 ? n : 1;
    memset(w, 0, sizeof *w);
    if (sim->def.bounce == GRANULATION_CONSERVING) { /* reversal turns velocities about zero, not about their mean */
        for (int i = 0; i < n; i++) {
            w->mean[0] += sim->vx[i] / count;
            w->mean[1] += sim->vy[i] / count;
            w->mean[2] += sim->vz[i] / count;
        }
    }
    for (int i = 0; i < n; i++) {
        double speed = granulation__frame_speed(sim, w, i), radius = 0.5 * sim->body[i].diameter;
        w->fastest = speed > w->fastest ? speed : w->fastest;
        w->widest = radius > w->widest ? radius : w->widest;
        motion[i].time = motion[i].jump = 0.0;
        motion[i].stamp = motion[i].gone = 0;
    }
    double room = 0.5 * box - 2.0 * w->widest;
    if (!(room > 0.0)) return GRANULATION_TOO_LARGE;
    w->spacing = box / riddle_cbrt(count);
    /* half and twice the spacing were measured to cost more */
    double skin = w->spacing < 0.5 * room ? w->spacing : 0.5 * room;
    double parts = w->fastest * longest > 0.5 * skin ? floor(w->fastest * longest / (0.5 * skin)) + 1.0 : 1.0;
    w->end = longest / parts;
    if (!(w->end > 0.0)) return GRANULATION_EVENTS;
    w->allowed = 0.5 * room / w->end;
    sim->events = 0;
    if (!granulation__sort(sim, &w->cells)) return GRANULATION_NO_MEMORY;
    const granulation__item *items = (const granulation__item *)sim->items;
    for (int a = 0; a < n; a++) motion[items[a].id].item = a;
    return GRANULATION_OK;
}

/* Adds the contacts of every pair at the start of the sweep to the heap, each pair once. */
static inline bool granulation__predict_all(granulation_sim *sim, const granulation__sweep *w) {
    const granulation__item *items = (const granulation__item *)sim->items;
    double box = sim->def.box, other = w->fastest * w->end;
    for (int a = 0; a < sim->n; a++) {
        const granulation__item p = items[a];
        double sx = p.vx - w->mean[0], sy = p.vy - w->mean[1], sz = p.vz - w->mean[2];
        double reach = granulation__reach(sim->def.contact, p.radius, w->widest) +
                       sqrt(sx * sx + sy * sy + sz * sz) * w->end + other;
        granulation__walk walk = granulation__near(sim, w->cells, p.x, p.y, p.z, reach * (1.0 + 1e-12));
        while (granulation__next(&walk))
            for (int b = walk.from > a ? walk.from : a + 1; b < walk.to; b++) {
                const granulation__item *q = items + b;
                double dx = granulation__nearest(p.x - q->x, box), dy = granulation__nearest(p.y - q->y, box);
                double dz = granulation__nearest(p.z - q->z, box);
                double t = granulation__contact_time(dx, dy, dz, p.vx - q->vx, p.vy - q->vy, p.vz - q->vz,
                                                     granulation__reach(sim->def.contact, p.radius, q->radius));
                if (!(t >= 0.0 && t <= w->end)) continue;
                granulation__hit hit = {t, p.id < q->id ? p.id : q->id, p.id < q->id ? q->id : p.id, 0, 0};
                if (!granulation__push(sim, hit)) return false;
            }
    }
    return true;
}

/* Handles one contact of the heap. A contact that was predicted before one of the two met another granule has
   an old stamp. */
static inline granulation_status granulation__handle(granulation_sim *sim, granulation__sweep *w, granulation__hit hit,
                                                     double time) {
    granulation__motion *motion = (granulation__motion *)sim->motion;
    int i = hit.i, j = hit.j;
    granulation__bring(sim, i, hit.time);
    granulation__bring(sim, j, hit.time);
    double box = sim->def.box, dx = granulation__nearest(sim->x[i] - sim->x[j], box),
           dy = granulation__nearest(sim->y[i] - sim->y[j], box), dz = granulation__nearest(sim->z[i] - sim->z[j], box),
           mi = sim->body[i].mass, mj = sim->body[j].mass;
    bool merged = granulation__meet(sim, i, j, time);
    if (merged) { /* one granule: it takes the item of the heavier half, from where the jump is shorter */
        if (mj > mi) {
            granulation__item *items = (granulation__item *)sim->items;
            const int item = motion[i].item;
            items[motion[i].item].id = j;
            items[motion[j].item].id = i;
            motion[i].item = motion[j].item;
            motion[i].jump = motion[j].jump;
            motion[j].item = item;
        }
        granulation__jump(sim, w, i, (mi < mj ? mi : mj) / (mi + mj) * sqrt(dx * dx + dy * dy + dz * dz));
    }
    motion[i].stamp++;
    motion[j].stamp++;
    double radius = 0.5 * sim->body[i].diameter, speed_i = granulation__frame_speed(sim, w, i);
    double speed_j = merged ? 0.0 : granulation__frame_speed(sim, w, j);
    w->widest = radius > w->widest ? radius : w->widest;
    w->fastest = speed_i > w->fastest ? speed_i : w->fastest;
    w->fastest = speed_j > w->fastest ? speed_j : w->fastest;
    if (merged && !(2.0 * radius < 0.5 * sim->def.box)) return GRANULATION_TOO_LARGE;
    bool known = merged ? granulation__make_room(sim, w, i, hit.time) : granulation__predict(sim, w, j, hit.time);
    return known && granulation__predict(sim, w, i, hit.time) ? GRANULATION_OK : GRANULATION_NO_MEMORY;
}

/* Moves the granules through a step, contact by contact. *to_go: the path time left, also when it stops early. */
static inline granulation_status granulation__swept_step(granulation_sim *sim, double begun, double *to_go) {
    const double path_time = sim->def.step / sim->def.dilation;
    double left = *to_go;
    int64_t budget = sim->def.most_events * (sim->n + (int64_t)1), sweeps = 0;
    granulation_status status = GRANULATION_OK;
    while (left > 0.0 && status == GRANULATION_OK) {
        granulation__sweep w;
        status = ++sweeps > 1000000 ? GRANULATION_EVENTS : granulation__begin_sweep(sim, &w, left);
        if (status != GRANULATION_OK) return status;
        if (!granulation__predict_all(sim, &w)) return GRANULATION_NO_MEMORY;
        const granulation__motion *motion = (const granulation__motion *)sim->motion;
        double stop = w.end;
        for (int i = 0; left == path_time && i < sim->n; i++) { /* daughters take their mother's place, and one beside
                                                                   it */
            if (sim->broken[i] != sim->steps || granulation__make_room(sim, &w, i, 0.0)) continue;
            status = GRANULATION_NO_MEMORY;
            stop = 0.0;
            break;
        }
        while (sim->events > 0 && status == GRANULATION_OK) {
            granulation__hit hit = granulation__pop(sim);
            if (motion[hit.i].gone || motion[hit.j].gone || motion[hit.i].stamp != hit.stamp_i ||
                motion[hit.j].stamp != hit.stamp_j)
                continue;
            if (sim->def.bounce == GRANULATION_REVERSAL &&
                (hit.stamp_i >= GRANULATION__LOCKED || hit.stamp_j >= GRANULATION__LOCKED))
                continue;
            status =
                granulation__handle(sim, &w, hit, begun + sim->def.step * ((path_time - left + hit.time) / path_time));
            if (--budget < 0) status = GRANULATION_EVENTS;
            if (status == GRANULATION_OK && w.fastest <= w.allowed && w.shift <= 0.25 * w.spacing + w.widest) continue;
            stop = hit.time; /* a new sweep with new bounds */
            break;
        }
        for (int i = 0; i < sim->n; i++)
            if (!motion[i].gone) granulation__bring(sim, i, stop);
        granulation__compact(sim);
        left = *to_go = stop < left ? left - stop : 0.0;
    }
    return status;
}

/* ---- one step ---- */

static inline void granulation__consolidate_all(granulation_sim *sim) {
    double decay = riddle_exp(-sim->def.consolidation * sim->def.step),
           capillary = granulation__capillary(&sim->def.laws);
    /* Summed apart: the ledger would lose the digits of small terms. */
    double released = 0.0, px = 0.0, py = 0.0, pz = 0.0;
    for (int i = 0; i < sim->n; i++) {
        granulation_granule g = sim->body[i].volumes;
        double air = granulation__consolidated(g.s + g.l, g.a, decay), before = sim->body[i].mass;
        released += g.a - air;
        g.a = air;
        sim->body[i] = granulation__body(&sim->def.laws, &g, capillary);
        before -= sim->body[i].mass;
        px += before * sim->vx[i];
        py += before * sim->vy[i];
        pz += before * sim->vz[i];
    }
    sim->ledger.air_released += released;
    sim->ledger.momentum[0] -= px;
    sim->ledger.momentum[1] -= py;
    sim->ledger.momentum[2] -= pz;
}

/* Breaks granules by (28), (36): into two halves that touch and have the same velocity, in a random direction about
   the old centre. */
static inline granulation_status granulation__break_all(granulation_sim *sim) {
    int n = sim->n;
    for (int i = 0; i < n; i++) {
        double speed = sqrt(sim->vx[i] * sim->vx[i] + sim->vy[i] * sim->vy[i] + sim->vz[i] * sim->vz[i]);
        if (!granulation_breaks(&sim->def.laws, sim->body + i, speed)) continue;
        bool resting = sim->broken[i] >= 0 && sim->steps - sim->broken[i] <= sim->def.breakage_rest;
        if (resting || granulation_volume(&sim->body[i].volumes) < sim->def.breakage_least_volume) {
            sim->tally.refused_breakages++;
            continue;
        }
        if (sim->n >= sim->def.most_granules) return GRANULATION_POPULATION;
        granulation_status status = granulation__reserve(sim, (int64_t)sim->n + 1);
        if (status != GRANULATION_OK) return status;
        double x, y, z, length2;
        do {
            x = 2.0 * granulation_random_uniform(&sim->random) - 1.0;
            y = 2.0 * granulation_random_uniform(&sim->random) - 1.0;
            z = 2.0 * granulation_random_uniform(&sim->random) - 1.0;
            length2 = x * x + y * y + z * z;
        } while (!(length2 > 1e-6 && length2 <= 1.0));
        granulation_granule half = granulation_half(&sim->body[i].volumes);
        granulation_body body = granulation_body_of(&sim->def.laws, &half);
        double arm = 0.5 * body.diameter * (1.0 + 1e-14) / sqrt(length2), box = sim->def.box;
        int j = sim->n++;
        sim->x[j] = granulation__wrap(sim->x[i] - arm * x, box);
        sim->y[j] = granulation__wrap(sim->y[i] - arm * y, box);
        sim->z[j] = granulation__wrap(sim->z[i] - arm * z, box);
        sim->x[i] = granulation__wrap(sim->x[i] + arm * x, box);
        sim->y[i] = granulation__wrap(sim->y[i] + arm * y, box);
        sim->z[i] = granulation__wrap(sim->z[i] + arm * z, box);
        sim->vx[j] = sim->vx[i];
        sim->vy[j] = sim->vy[i];
        sim->vz[j] = sim->vz[i];
        granulation__note_momentum(sim, i, 2.0 * body.mass - sim->body[i].mass, 1.0); /* round-off of the two masses */
        sim->body[i] = sim->body[j] = body;
        sim->broken[i] = sim->broken[j] = sim->steps;
        sim->tally.breakages++;
    }
    return GRANULATION_OK;
}

static inline void granulation__stir(granulation_sim *sim) {
    double chance = -riddle_expm1(-sim->def.stirring * sim->def.step);
    for (int i = 0; i < sim->n; i++) {
        if (granulation_random_uniform(&sim->random) >= chance) continue;
        granulation__note_momentum(sim, i, sim->body[i].mass, -1.0);
        double velocity[3];
        granulation__draw_velocity(sim, velocity);
        sim->vx[i] = velocity[0];
        sim->vy[i] = velocity[1];
        sim->vz[i] = velocity[2];
        granulation__note_momentum(sim, i, sim->body[i].mass, 1.0);
    }
}

/* The part of a step that comes next. A step that was stopped keeps its stage; time has already advanced over it. */
enum { GRANULATION__BEGIN, GRANULATION__BREAK, GRANULATION__MOVE };

/* Finishes a step from its stage on. begun: time at the start of the step [s]. */
static inline granulation_status granulation__finish_step(granulation_sim *sim, double begun) {
    if (sim->stage == GRANULATION__BREAK) {
        granulation_status status = sim->def.breakage ? granulation__break_all(sim) : GRANULATION_OK;
        if (status != GRANULATION_OK) return status;
        if (sim->def.stirring > 0.0) granulation__stir(sim);
        sim->stage = GRANULATION__MOVE;
    }
    granulation_status status = sim->def.detection == GRANULATION_SWEPT
                                    ? granulation__swept_step(sim, begun, &sim->owed)
                                    : granulation__end_of_step(sim, begun, &sim->owed);
    if (status != GRANULATION_OK) return status;
    sim->stage = GRANULATION__BEGIN;
    sim->owed = 0.0;
    sim->steps++;
    for (int i = 0; i < sim->n; i++)
        if (!(sim->body[i].diameter < 0.5 * sim->def.box)) return GRANULATION_TOO_LARGE;
    return GRANULATION_OK;
}

GRANULATION_API granulation_status granulation_sim_run(granulation_sim *sim, int steps) {
    if (!sim || steps < 0 || sim->def.cookie != GRANULATION__COOKIE) return GRANULATION_BAD_ARGUMENT;
    if (sim->stage != GRANULATION__BEGIN && steps > 0) {
        granulation_status status = granulation__finish_step(sim, sim->time - sim->def.step);
        if (status != GRANULATION_OK) return status;
    }
    for (int k = 0; k < steps; k++) {
        const double begun = sim->time;
        granulation__consolidate_all(sim);
        sim->time += sim->def.step;
        sim->owed = sim->def.step / sim->def.dilation;
        sim->stage = GRANULATION__BREAK;
        granulation_status status = granulation__finish_step(sim, begun);
        if (status != GRANULATION_OK) return status;
    }
    return GRANULATION_OK;
}

/* ---- changes in mid-run ---- */

static inline void granulation__refresh(granulation_sim *sim) {
    double capillary = granulation__capillary(&sim->def.laws);
    for (int i = 0; i < sim->n; i++) {
        double before = sim->body[i].mass;
        granulation_granule g = sim->body[i].volumes;
        sim->body[i] = granulation__body(&sim->def.laws, &g, capillary);
        granulation__note_momentum(sim, i, sim->body[i].mass - before, 1.0);
    }
}

GRANULATION_API granulation_status granulation_sim_set(granulation_sim *sim, const granulation_def *def) {
    if (!sim || !def) return GRANULATION_BAD_ARGUMENT;
    granulation_status status = granulation_check_def(def, NULL);
    if (status != GRANULATION_OK) return status;
    if (def->box != sim->def.box) return GRANULATION_BAD_ARGUMENT;
    granulation_memory memory = sim->def.memory;
    sim->def = *def;
    sim->def.memory = memory;
    granulation__refresh(sim);
    return GRANULATION_OK;
}

/* Returns a velocity with the same deviate about a new mean with a new deviation. */
static inline double granulation__stretched(double v, double sign, double old_mean, double old_deviation, double mean,
                                            double deviation) {
    return sign * mean + (v - sign * old_mean) * (deviation / old_deviation);
}
static inline double granulation__stream_of(const granulation_sim *sim, double v, double old_mean) {
    return sim->def.signs != GRANULATION_SAME_SIGNS && v * old_mean < 0.0 ? -1.0 : 1.0;
}

/* Returns whether the granules' velocities stay moderate; they do not where the old deviation was next to nothing and
   the new one is not. */
static inline bool granulation__can_stretch(const granulation_sim *sim, const double mean[3],
                                            const double deviation[3]) {
    const double *velocity[3] = {sim->vx, sim->vy, sim->vz}, *old_mean = sim->def.velocity_mean,
                 *old = sim->def.velocity_deviation;
    for (int i = 0; i < sim->n; i++)
        for (int k = 0; k < 3; k++) {
            const double v = velocity[k][i], sign = granulation__stream_of(sim, v, old_mean[k]);
            if (old[k] > 0.0 &&
                !(fabs(granulation__stretched(v, sign, old_mean[k], old[k], mean[k], deviation[k])) < 1e100))
                return false;
        }
    return true;
}

GRANULATION_API granulation_status granulation_sim_impeller(granulation_sim *sim, const double mean[3],
                                                            const double deviation[3], bool redraw) {
    if (!sim || !mean || !deviation) return GRANULATION_BAD_ARGUMENT;
    for (int k = 0; k < 3; k++)
        if (!(fabs(mean[k]) < 1e100 && deviation[k] >= 0.0 && deviation[k] < 1e100)) return GRANULATION_BAD_ARGUMENT;
    double old_mean[3], old_deviation[3];
    memcpy(old_mean, sim->def.velocity_mean, sizeof old_mean);
    memcpy(old_deviation, sim->def.velocity_deviation, sizeof old_deviation);
    if (!redraw && !granulation__can_stretch(sim, mean, deviation)) return GRANULATION_BAD_ARGUMENT;
    memcpy(sim->def.velocity_mean, mean, sizeof old_mean);
    memcpy(sim->def.velocity_deviation, deviation, sizeof old_deviation);
    double *velocity[3] = {sim->vx, sim->vy, sim->vz};
    for (int i = 0; i < sim->n; i++) {
        double fresh[3] = {0.0, 0.0, 0.0};
        granulation__note_momentum(sim, i, sim->body[i].mass, -1.0);
        if (redraw || !(old_deviation[0] > 0.0 && old_deviation[1] > 0.0 && old_deviation[2] > 0.0))
            granulation__draw_velocity(sim, fresh);
        for (int k = 0; k < 3; k++) {
            double v = velocity[k][i], sign = granulation__stream_of(sim, v, old_mean[k]);
            velocity[k][i] =
                redraw || !(old_deviation[k] > 0.0)
                    ? fresh[k]
                    : granulation__stretched(v, sign, old_mean[k], old_deviation[k], mean[k], deviation[k]);
        }
        granulation__note_momentum(sim, i, sim->body[i].mass, 1.0);
    }
    return GRANULATION_OK;
}

GRANULATION_API granulation_status granulation_sim_spray(granulation_sim *sim, double volume, double displaced) {
    if (!sim || !(volume >= 0.0 && volume < HUGE_VAL) || !(displaced >= 0.0 && displaced <= 1.0))
        return GRANULATION_BAD_ARGUMENT;
    double surface = 0.0;
    for (int i = 0; i < sim->n; i++) surface += sim->body[i].diameter * sim->body[i].diameter;
    if (!(surface > 0.0)) return volume > 0.0 ? GRANULATION_BAD_ARGUMENT : GRANULATION_OK;
    for (int refuse = 1; refuse >= 0; refuse--) /* first only checks */
        for (int i = 0; i < sim->n; i++) {
            granulation_granule g = sim->body[i].volumes;
            double more = volume * (sim->body[i].diameter * sim->body[i].diameter / surface), out = displaced * more;
            out = out < g.a ? out : g.a;
            g.l += more;
            g.a -= out;
            if (refuse) {
                if (!(granulation_diameter(granulation_volume(&g)) < 0.5 * sim->def.box)) return GRANULATION_TOO_LARGE;
                continue;
            }
            sim->body[i].volumes = g;
            sim->ledger.liquid += more;
            sim->ledger.air_released += out;
        }
    granulation__refresh(sim);
    return GRANULATION_OK;
}

/* ---- properties of the population ---- */

static inline double granulation__power(double x, int k) {
    double y = 1.0;
    while (k-- > 0) y *= x;
    return y;
}
/* Returns (above / below)^(1/k); NaN unless below > 0. */
static inline double granulation__mean_of(double above, double below, int k) {
    if (!(below > 0.0)) return (double)NAN;
    return k == 1 ? above / below : k == 3 ? riddle_cbrt(above / below) : riddle_pow(above / below, 1.0 / k);
}

/* Returns the volume of the granules up to one of volume v; *next: the volume of the smallest larger one,
   or HUGE_VAL. */
static inline double granulation__volume_up_to(const granulation_sim *sim, double v, double *next) {
    double sum = 0.0;
    *next = HUGE_VAL;
    for (int i = 0; i < sim->n; i++) {
        const double own = granulation_volume(&sim->body[i].volumes);
        if (own <= v) sum += own;
        else if (own < *next) *next = own;
    }
    return sum;
}

GRANULATION_API double granulation_sim_percentile(const granulation_sim *sim, double share) {
    double low = 0.0, high = 0.0, all, next; /* volumes: up to low there is too little, up to high enough */
    if (!sim || sim->n < 1 || !(share > 0.0 && share <= 1.0)) return (double)NAN;
    for (int i = 0; i < sim->n; i++) {
        const double own = granulation_volume(&sim->body[i].volumes);
        high = own > high ? own : high;
    }
    all = granulation__volume_up_to(sim, high, &next);
    for (int k = 0; k < 100 && low < high; k++) {
        const double middle = 0.5 * (low + high);
        if (!(middle > low && middle < high)) break;
        if (granulation__volume_up_to(sim, middle, &next) >= share * all) high = middle;
        else low = middle;
    }
    granulation__volume_up_to(sim, low, &next); /* the granule that reaches it */
    return granulation_diameter(next);
}

GRANULATION_API double granulation_sim_mean(const granulation_sim *sim, int p, int q) {
    if (!sim || q < 0 || q >= p || p > 6) return (double)NAN;
    double above = 0.0, below = 0.0;
    for (int i = 0; i < sim->n; i++) { /* in units of the box: D^6 of a fine granule would underflow */
        double d = sim->body[i].diameter / sim->def.box;
        above += granulation__power(d, p);
        below += granulation__power(d, q);
    }
    return sim->def.box * granulation__mean_of(above, below, p - q);
}

GRANULATION_API int granulation_sim_classes(const granulation_sim *sim, const double *edges, int classes, double *count,
                                            double *q_s, double *q_l, double *q_a) {
    if (!sim || !edges || classes < 1) return sim ? sim->n : 0;
    double *out[4] = {count, q_s, q_l, q_a};
    for (int m = 0; m < 4; m++)
        for (int k = 0; out[m] && k < classes; k++) out[m][k] = 0.0;
    int outside = 0;
    for (int i = 0; i < sim->n; i++) {
        const granulation_granule *g = &sim->body[i].volumes;
        double v = granulation_volume(g);
        if (!(v >= edges[0] && v < edges[classes])) {
            outside++;
            continue;
        }
        int low = 0, high = classes;
        while (high - low > 1) {
            int middle = (low + high) / 2;
            if (v >= edges[middle]) low = middle;
            else high = middle;
        }
        if (count) count[low] += 1.0;
        if (q_s) q_s[low] += g->s;
        if (q_l) q_l[low] += g->l;
        if (q_a) q_a[low] += g->a;
    }
    return outside;
}

GRANULATION_API void granulation_sim_totals(const granulation_sim *sim, granulation_granule *volumes,
                                            double momentum[3], double *kinetic) {
    granulation_granule v = {0.0, 0.0, 0.0};
    double px = 0.0, py = 0.0, pz = 0.0, energy = 0.0;
    for (int i = 0; sim && i < sim->n; i++) {
        double m = sim->body[i].mass;
        v = granulation_sum(&v, &sim->body[i].volumes);
        px += m * sim->vx[i];
        py += m * sim->vy[i];
        pz += m * sim->vz[i];
        energy += 0.5 * m * (sim->vx[i] * sim->vx[i] + sim->vy[i] * sim->vy[i] + sim->vz[i] * sim->vz[i]);
    }
    if (volumes) *volumes = v;
    if (momentum) {
        momentum[0] = px;
        momentum[1] = py;
        momentum[2] = pz;
    }
    if (kinetic) *kinetic = energy;
}

GRANULATION_API granulation_status granulation_sim_map(const granulation_sim *sim, const double *st_v, int rows,
                                                       const double *st_def, int columns, granulation_reason *reasons) {
    if (!sim || sim->n < 1 || !st_v || !st_def || !reasons || rows < 1 || columns < 1) return GRANULATION_BAD_ARGUMENT;
    const granulation_laws *laws = &sim->def.laws;
    double film = 0.0, diameter = 0.0, yield = 0.0,
           asperity = granulation_asperity(laws->asperity_factor, laws->grain_diameter);
    for (int i = 0; i < sim->n; i++) {
        film += sim->body[i].film / sim->n;
        diameter += sim->body[i].diameter / sim->n;
        yield += sim->body[i].yield / sim->n;
    }
    double ratio = laws->stiffness == GRANULATION_FIXED_RATIO ? laws->yield_ratio : yield / laws->modulus;
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < columns; j++)
            reasons[(size_t)i * (size_t)columns + (size_t)j] =
                granulation_classify(laws, st_v[i], st_def[j], ratio, film / asperity, 0.5 * diameter / asperity);
    return GRANULATION_OK;
}

GRANULATION_API granulation_status granulation_sim_overlap(granulation_sim *sim, double *deepest) {
    int cells;
    if (!sim || !deepest) return GRANULATION_BAD_ARGUMENT;
    *deepest = 0.0;
    if (sim->n == 0) return GRANULATION_OK;
    if (!granulation__sort(sim, &cells)) return GRANULATION_NO_MEMORY;
    const granulation__item *items = (const granulation__item *)sim->items;
    double box = sim->def.box, widest = 0.0;
    for (int i = 0; i < sim->n; i++) widest = items[i].radius > widest ? items[i].radius : widest;
    for (int a = 0; a < sim->n; a++) {
        granulation__walk walk =
            granulation__near(sim, cells, items[a].x, items[a].y, items[a].z, items[a].radius + widest);
        while (granulation__next(&walk))
            for (int b = walk.from > a ? walk.from : a + 1; b < walk.to; b++) {
                double dx = granulation__nearest(items[a].x - items[b].x, box),
                       dy = granulation__nearest(items[a].y - items[b].y, box);
                double dz = granulation__nearest(items[a].z - items[b].z, box),
                       touch = items[a].radius + items[b].radius;
                double overlap = 1.0 - sqrt(dx * dx + dy * dy + dz * dz) / touch;
                if (overlap > *deepest) *deepest = overlap;
            }
    }
    return GRANULATION_OK;
}

GRANULATION_API const char *granulation_outside_text(unsigned flag) {
    switch (flag) {
#define GRANULATION__OUTSIDE_TEXT(name, value, text)                                                                   \
    case value: return text;
        GRANULATION_OUTSIDES(GRANULATION__OUTSIDE_TEXT)
#undef GRANULATION__OUTSIDE_TEXT
    }
    return "unknown flag";
}

/* Returns whether x is within low .. high; 1 % beyond is allowed. NaN is not. */
static inline bool granulation__within(double x, double low, double high) {
    return x >= 0.99 * low && x <= 1.01 * high;
}

/* Returns whether two materials are the same. */
static inline bool granulation__same_material(const granulation_def *a, const granulation_def *b) {
    const granulation_laws *p = &a->laws, *q = &b->laws;
    const double both[][2] = {
        {p->viscosity, q->viscosity},
        {p->solid_density, q->solid_density},
        {p->liquid_density, q->liquid_density},
        {p->air_density, q->air_density},
        {p->surface_tension, q->surface_tension},
        {p->contact_angle, q->contact_angle},
        {p->grain_diameter, q->grain_diameter},
        {p->shape_factor, q->shape_factor},
        {p->asperity_factor, q->asperity_factor},
        {p->poisson, q->poisson},
        {p->critical_saturation, q->critical_saturation},
        {p->yield_ratio, q->yield_ratio},
        {p->limit_diameter, q->limit_diameter},
        {p->limit_moisture, q->limit_moisture},
        {p->breakage_stokes, q->breakage_stokes},
        {p->flow_consistency, q->flow_consistency},
        {a->consolidation, b->consolidation},
    };
    bool same = p->convention == q->convention && p->stiffness == q->stiffness && p->pair_yield == q->pair_yield &&
                p->elastic_rule == q->elastic_rule && p->dry_rule == q->dry_rule && p->deep_film == q->deep_film &&
                p->limit == q->limit && p->limit_type_one == q->limit_type_one;
    for (size_t k = 0; k < sizeof both / sizeof *both; k++) same = same && both[k][0] == both[k][1];
    return same;
}

/* Returns whether two simulations move granules and find contacts by the same rules. */
static inline bool granulation__same_rules(const granulation_def *a, const granulation_def *b) {
    bool same = a->step == b->step && a->dilation == b->dilation && a->signs == b->signs &&
                a->detection == b->detection && a->contact == b->contact && a->bounce == b->bounce &&
                a->approaching_only == b->approaching_only && a->stirring == b->stirring &&
                a->breakage == b->breakage && a->breakage_least_volume == b->breakage_least_volume &&
                a->breakage_rest == b->breakage_rest;
    for (int k = 0; k < 3; k++) same = same && a->velocity_deviation[k] == b->velocity_deviation[k];
    return same;
}

GRANULATION_API unsigned granulation_sim_outside(const granulation_sim *sim) {
    if (!sim) return GRANULATION_OUTSIDE_NOTHING;
    const granulation_def fitted = granulation_paper_def();
    unsigned flags = GRANULATION_OUTSIDE_NOTHING;
    for (int k = 0; k < 3; k++)
        if (!granulation__within(fabs(sim->def.velocity_mean[k]), 1.0, 7.0)) flags |= GRANULATION_OUTSIDE_SPEED;
    if (!(sim->time <= 100.0 * (1.0 + 1e-9))) flags |= GRANULATION_OUTSIDE_TIME;
    if (!granulation__same_material(&sim->def, &fitted)) flags |= GRANULATION_OUTSIDE_MATERIAL;
    if (!granulation__same_rules(&sim->def, &fitted)) flags |= GRANULATION_OUTSIDE_RULES;
    if (sim->n == 0) return flags;
    granulation_granule all;
    granulation_sim_totals(sim, &all, NULL, NULL);
    const double box = sim->def.box;
    if (!granulation__within(all.l / (all.s + all.l), 0.15 / 0.85, 0.33 / 0.85)) flags |= GRANULATION_OUTSIDE_BINDER;
    if (!granulation__within(granulation_sim_mean(sim, 4, 3), 180e-6, 245e-6)) flags |= GRANULATION_OUTSIDE_SIZE;
    if (!granulation__within(granulation_volume(&all) / (box * box * box), 0.06, 0.09))
        flags |= GRANULATION_OUTSIDE_FILL;
    return flags;
}

/* ==== >>balance ==== */
#define GRANULATION__BALANCE_COOKIE UINT64_C(0x6772616e756c6532)

GRANULATION_API granulation_kernel_data granulation_default_kernel_data(void) {
    granulation_kernel_data k;
    k.rate = 1.0;
    k.a = k.b = k.speed = (double)NAN;
    k.limit = HUGE_VAL;
    k.laws = NULL;
    k.inner = NULL;
    return k;
}

GRANULATION_API granulation_balance_def granulation_balance_default_def(void) {
    granulation_balance_def d;
    memset(&d, 0, sizeof d);
    d.scheme = GRANULATION_CELL_AVERAGE;
    d.kernel = granulation_constant_kernel;
    d.daughters = GRANULATION_HALVES;
    d.tolerance = 1e-6;
    d.longest_step = HUGE_VAL;
    d.most_lost = 1e-3;
    d.most_steps = 1000000;
    d.cookie = GRANULATION__BALANCE_COOKIE;
    return d;
}

GRANULATION_API granulation_status granulation_balance_check_def(const granulation_balance_def *d, const char **field) {
    if (field) *field = d ? NULL : "def";
    if (!d) return GRANULATION_BAD_ARGUMENT;
    GRANULATION__NEED(d->cookie == GRANULATION__BALANCE_COOKIE, "cookie");
    GRANULATION__NEED(d->scheme == GRANULATION_CELL_AVERAGE || d->scheme == GRANULATION_FIXED_PIVOT, "scheme");
    GRANULATION__NEED(d->daughters == GRANULATION_HALVES || d->daughters == GRANULATION_UNIFORM ||
                          d->daughters == GRANULATION_OWN,
                      "daughters");
    GRANULATION__NEED(d->daughters != GRANULATION_OWN || d->breakage, "breakage");
    GRANULATION__NEED(d->consolidation >= 0.0 && granulation__finite(d->consolidation), "consolidation");
    GRANULATION__NEED(d->tolerance > 0.0 && granulation__finite(d->tolerance), "tolerance");
    GRANULATION__NEED(d->longest_step > 0.0, "longest_step");
    GRANULATION__NEED(d->most_lost >= 0.0 && d->most_lost <= 1.0, "most_lost");
    GRANULATION__NEED(d->most_steps >= 1, "most_steps");
    return GRANULATION_OK;
}

/* The state: number, then the carried quantities (liquid with one component, air), cell by cell, then four totals lost:
   number, solid, liquid, air. */
static inline int granulation__fields(const granulation_balance *b) { return b->components == 1 ? 3 : 2; }
static inline size_t granulation__length(const granulation_balance *b) {
    return (size_t)granulation__fields(b) * (size_t)b->n + 4;
}

/* Returns the index of the pivot at or below a key; -1 below the first. */
static inline int granulation__below(const double *pivot, int n, double key) {
    if (!(key >= pivot[0])) return -1;
    int low = 0, high = n;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (key >= pivot[middle]) low = middle;
        else high = middle;
    }
    return low;
}

/* Where a granule between pivots goes: `cell` and its upper neighbours, share `f` upwards along each key: number and
   keys are kept */
typedef struct granulation__place_of {
    int cell; /* negative: beyond the last pivots (or below the first) */
    double f[2];
} granulation__place_of;

static inline granulation__place_of granulation__share(const granulation_balance *b, double key0, double key1) {
    granulation__place_of p;
    int at[2] = {0, 0};
    p.f[0] = p.f[1] = 0.0;
    p.cell = -1;
    for (int k = 0; k < b->components; k++) {
        const double *pivot = b->pivot[k];
        double key = k ? key1 : key0;
        int n = b->size[k];
        /* round-off: a sum may be slightly beyond the last pivot, a half slightly below the first */
        if (key > pivot[n - 1] && key <= pivot[n - 1] * (1.0 + 1e-14)) key = pivot[n - 1];
        if (key < pivot[0] && key >= pivot[0] * (1.0 - 1e-14)) key = pivot[0];
        if (!(key <= pivot[n - 1])) return p;
        at[k] = granulation__below(pivot, n, key);
        if (at[k] < 0) return p;
        if (at[k] < n - 1) p.f[k] = (key - pivot[at[k]]) / (pivot[at[k] + 1] - pivot[at[k]]);
    }
    p.cell = at[0] + b->size[0] * at[1];
    return p;
}

/* Returns the mean key along key k of the granules formed in cell `at`. All terms lie within the cell's edges and below
   the last pivot. By round-off, overflow or underflow of its terms, the mean of thousands may not, so it is limited. */
static inline double granulation__mean_key(const granulation_balance *b, int k, int at, double sum, double count) {
    double low = b->edge[k][at], high = b->edge[k][at + 1], first = b->pivot[k][0], last = b->pivot[k][b->size[k] - 1],
           mean = sum / count;
    low = low > first ? low : first;
    high = high < last ? high : last;
    return !(mean > low) ? low : mean < high ? mean : high;
}

/* Adds number and carried contents to the up to four pivots of a place, which must be one. Contents go by the key
   volume that a pivot gets, so that composition follows volume. */
static inline void granulation__deposit(const granulation_balance *b, double *state, const granulation__place_of *p,
                                        double number, double liquid, double air) {
    if (p->cell < 0 || p->cell >= b->n) return; /* no caller does; the sums would show it */
    int n0 = b->size[0], i0 = p->cell % n0, i1 = p->cell / n0;
    double weight[4], volume[4], all = 0.0;
    int cell[4], corners = 0;
    for (int c = 0; c < 2 * b->components; c++) {
        double w = (c & 1 ? p->f[0] : 1.0 - p->f[0]) * (b->components == 1 ? 1.0 : c & 2 ? p->f[1] : 1.0 - p->f[1]);
        if (!(w > 0.0) || i0 + (c & 1) >= n0 || i1 + (c >> 1) >= b->size[1]) continue;
        int j0 = i0 + (c & 1), j1 = i1 + (c >> 1);
        cell[corners] = j0 + n0 * j1;
        weight[corners] = w;
        volume[corners] = w * (b->components == 1 ? b->pivot[0][j0] : b->pivot[0][j0] + b->pivot[1][j1]);
        all += volume[corners++];
    }
    double *carried = state + b->n;
    for (int c = 0; c < corners; c++) {
        double part = volume[c] / all;
        state[cell[c]] += weight[c] * number;
        if (b->components == 1) {
            carried[cell[c]] += part * liquid;
            carried[b->n + cell[c]] += part * air;
        } else {
            carried[cell[c]] += part * air;
        }
    }
}

static inline void granulation__point(granulation_balance *b) {
    size_t n = (size_t)b->n;
    b->number = b->state;
    b->liquid = b->components == 1 ? b->state + n : NULL;
    b->air = b->components == 1 ? b->state + 2 * n : b->state + n;
}

GRANULATION_API void granulation_balance_free(granulation_balance *b) {
    if (!b) return;
    void *blocks[9] = {b->edge[0], b->pivot[0], b->edge[1], b->pivot[1], b->target,
                       b->share,   b->kernel,   b->state,   b->births};
    for (int k = 0; k < 9; k++) granulation__memory(&b->def.memory, blocks[k], blocks[k] ? b->bytes[k] : 0, 0);
    memset(b, 0, sizeof *b);
}

GRANULATION_API granulation_status granulation_balance_init(granulation_balance *b, const granulation_balance_def *def,
                                                            int cells, const double *edges, const double *pivots,
                                                            int l_cells, const double *l_edges,
                                                            const double *l_pivots) {
    if (!b) return GRANULATION_BAD_ARGUMENT;
    memset(b, 0, sizeof *b);
    granulation_status status = granulation_balance_check_def(def, NULL);
    if (status != GRANULATION_OK) return status;
    if (cells < 2 || !edges || l_cells < 0 || l_cells == 1 || (l_cells > 0) != (l_edges != NULL) || cells > 100000 ||
        l_cells > 100000 || (int64_t)cells * (l_cells ? l_cells : 1) > 100000 ||
        (l_cells && def->daughters != GRANULATION_HALVES))
        return GRANULATION_BAD_ARGUMENT;
    const double *given_edges[2] = {edges, l_edges}, *given_pivots[2] = {pivots, l_pivots};
    int given[2] = {cells, l_cells};
    for (int k = 0; k < (l_cells ? 2 : 1); k++)
        for (int i = 0; i < given[k]; i++) {
            double low = given_edges[k][i], high = given_edges[k][i + 1],
                   pivot = given_pivots[k] ? given_pivots[k][i] : 0.5 * (low + high);
            if (!(low >= 0.0 && high > low && high < HUGE_VAL && pivot >= low && pivot <= high))
                return GRANULATION_BAD_ARGUMENT;
            if (!(pivot > 0.0 || (k == 1 && i == 0)) || (i > 0 && given_pivots[k] && !(pivot > given_pivots[k][i - 1])))
                return GRANULATION_BAD_ARGUMENT;
        }
    b->def = *def;
    b->components = l_cells ? 2 : 1;
    b->size[0] = cells;
    b->size[1] = l_cells ? l_cells : 1;
    b->n = cells * b->size[1];
    b->pairs = (int64_t)b->n * (b->n + 1) / 2;
    size_t n = (size_t)b->n, pairs = (size_t)b->pairs, length = granulation__length(b);
    bool fixed = def->scheme == GRANULATION_FIXED_PIVOT;
    /* state and base, two stages and one rate of the integrator; loss, selection, and the sums of the cell average */
    size_t doubles = 5 * length + 2 * n + 6 * n;
    b->bytes[0] = ((size_t)cells + 1) * sizeof(double);
    b->bytes[1] = (size_t)cells * sizeof(double);
    b->bytes[2] = l_cells ? ((size_t)l_cells + 1) * sizeof(double) : 0;
    b->bytes[3] = l_cells ? (size_t)l_cells * sizeof(double) : 0;
    b->bytes[4] = def->kernel ? pairs * sizeof(int) : 0;
    b->bytes[5] = def->kernel && fixed ? pairs * (size_t)b->components * sizeof(double) : 0;
    b->bytes[6] = def->kernel ? pairs * sizeof(double) : 0;
    b->bytes[7] = doubles * sizeof(double);
    b->bytes[8] = def->daughters == GRANULATION_OWN ? pairs * sizeof(double) : 0;
    void *blocks[9];
    memset(blocks, 0, sizeof blocks);
    for (int k = 0; k < 9; k++) {
        if (b->bytes[k]) blocks[k] = granulation__memory(&def->memory, NULL, 0, b->bytes[k]);
        if (blocks[k] || !b->bytes[k]) continue;
        while (k-- > 0) granulation__memory(&def->memory, blocks[k], blocks[k] ? b->bytes[k] : 0, 0);
        memset(b, 0, sizeof *b);
        return GRANULATION_NO_MEMORY;
    }
    b->edge[0] = (double *)blocks[0];
    b->pivot[0] = (double *)blocks[1];
    b->edge[1] = (double *)blocks[2];
    b->pivot[1] = (double *)blocks[3];
    b->target = (int *)blocks[4];
    b->share = (double *)blocks[5];
    b->kernel = (double *)blocks[6];
    b->state = (double *)blocks[7];
    b->births = (double *)blocks[8];
    b->work = b->state + length;
    for (int k = 0; k < b->components; k++)
        for (int i = 0; i <= given[k]; i++) {
            b->edge[k][i] = given_edges[k][i];
            if (i < given[k])
                b->pivot[k][i] =
                    given_pivots[k] ? given_pivots[k][i] : 0.5 * (given_edges[k][i] + given_edges[k][i + 1]);
        }
    memset(b->state, 0, b->bytes[7]);
    granulation__point(b);
    b->next_step = -1.0; /* kernel and selection have not been evaluated */
    if (!def->kernel) return GRANULATION_OK;
    size_t p = 0;
    for (int i = 0; i < b->n; i++)
        for (int j = i; j < b->n; j++, p++) {
            int i0 = i % cells, i1 = i / cells, j0 = j % cells, j1 = j / cells;
            double key0 = b->pivot[0][i0] + b->pivot[0][j0], key1 = l_cells ? b->pivot[1][i1] + b->pivot[1][j1] : 0.0;
            granulation__place_of place = granulation__share(b, key0, key1);
            b->target[p] = place.cell;
            b->kernel[p] = 0.0;
            if (fixed) {
                for (int k = 0; k < b->components; k++) b->share[p * (size_t)b->components + (size_t)k] = place.f[k];
            } else if (place.cell >= 0) { /* the cell that holds the sum */
                int at[2] = {0, 0};
                for (int k = 0; k < b->components; k++) {
                    at[k] = granulation__below(b->edge[k], b->size[k], k ? key1 : key0);
                    if (at[k] < 0) at[k] = 0;
                }
                b->target[p] = at[0] + cells * at[1];
            }
        }
    return GRANULATION_OK;
}

GRANULATION_API granulation_status granulation_balance_set(granulation_balance *b, const granulation_balance_def *def) {
    if (!b || !b->state) return GRANULATION_BAD_ARGUMENT;
    granulation_status status = granulation_balance_check_def(def, NULL);
    if (status != GRANULATION_OK) return status;
    if (def->scheme != b->def.scheme || (def->kernel && !b->target) ||
        (b->components == 2 && def->daughters != GRANULATION_HALVES) ||
        (def->daughters == GRANULATION_OWN && !b->births))
        return GRANULATION_BAD_ARGUMENT;
    granulation_memory memory = b->def.memory;
    b->def = *def;
    b->def.memory = memory;
    b->next_step = -1.0;
    return GRANULATION_OK;
}

GRANULATION_API granulation_status granulation_balance_add(granulation_balance *b, const granulation_granule *g,
                                                           double number) {
    if (!b || !b->state || !g || !(number >= 0.0 && number < HUGE_VAL) || !granulation__is_granule(g))
        return GRANULATION_BAD_ARGUMENT;
    granulation__place_of p =
        b->components == 1 ? granulation__share(b, g->s + g->l, 0.0) : granulation__share(b, g->s, g->l);
    if (p.cell < 0) return GRANULATION_BAD_ARGUMENT;
    granulation__deposit(b, b->state, &p, number, number * g->l, number * g->a);
    b->total.s += number * g->s;
    b->total.l += number * g->l;
    b->total.a += number * g->a;
    return GRANULATION_OK;
}

/* ---- rates ---- */

/* Returns where the halves of the granules of a cell go; used both for the test whether they break and for
   the breakage. */
static inline granulation__place_of granulation__halves(const granulation_balance *b, int i) {
    return granulation__share(b, 0.5 * b->pivot[0][i % b->size[0]],
                              b->components == 1 ? 0.0 : 0.5 * b->pivot[1][i / b->size[0]]);
}

/* Finds how many granules are born in each cell where one of cell `mother` breaks by the given function: between two
   pivots the daughters' number and volume are shared (Kumar and Ramkrishna 1996); below the first only their
   volume is kept. */
static inline granulation_status granulation__find_daughters(granulation_balance *b, int mother) {
    enum { PARTS = 32 };
    const double *x = b->pivot[0], u = x[mother];
    double *born = b->births + (size_t)mother * ((size_t)mother + 1) / 2;
    double below = b->def.breakage(x[0] / u, u, b->def.breakage_user);
    memset(born, 0, ((size_t)mother + 1) * sizeof(double));
    if (!(below >= 0.0)) return GRANULATION_KERNEL;
    born[0] = below * u / x[0];
    for (int i = 0; i < mother; i++) {
        double ratio = x[i + 1] / x[i], number = 0.0, volume = 0.0, from = x[i];
        for (int halvings = 0; halvings < 5; halvings++) ratio = sqrt(ratio);
        for (int part = 1; part <= PARTS; part++) {
            const double to = part < PARTS ? from * ratio : x[i + 1];
            const double finer = b->def.breakage(to < u ? to / u : 1.0, u, b->def.breakage_user), share = finer - below;
            if (!(share >= -1e-12 && finer <= 1.0 + 1e-9)) return GRANULATION_KERNEL;
            number += share * u / sqrt(from * to), volume += share * u;
            from = to, below = finer;
        }
        double up = (volume - x[i] * number) / (x[i + 1] - x[i]);
        born[i] += number - up, born[i + 1] += up;
    }
    return fabs(below - 1.0) <= 1e-9 ? GRANULATION_OK : GRANULATION_KERNEL;
}

static inline granulation_status granulation__evaluate_kernel(granulation_balance *b) {
    double *selection = b->work + 4 * granulation__length(b) + (size_t)b->n;
    size_t p = 0;
    for (int i = 0; i < b->n; i++) {
        granulation_granule g = granulation_balance_cell(b, i);
        double rate = 0.0;
        if (b->def.selection) {
            rate = b->def.selection(&g, b->def.selection_user);
            if (!(rate >= 0.0 && rate < HUGE_VAL)) return GRANULATION_KERNEL;
            /* They have no pivot. */
            if (b->def.daughters == GRANULATION_HALVES && granulation__halves(b, i).cell < 0) rate = 0.0;
        }
        selection[i] = rate;
        if (rate > 0.0 && b->def.daughters == GRANULATION_OWN) {
            granulation_status status = granulation__find_daughters(b, i);
            if (status != GRANULATION_OK) return status;
        }
        if (!b->def.kernel) continue;
        for (int j = i; j < b->n; j++, p++) {
            granulation_granule h = granulation_balance_cell(b, j);
            double k = b->def.kernel(&g, &h, b->def.kernel_user);
            if (!(k >= 0.0 && k < HUGE_VAL)) return GRANULATION_KERNEL;
            b->kernel[p] = k;
        }
    }
    return GRANULATION_OK;
}

/* Cells that hold less than this share of the number and of the square volume do not coalesce (measured: four times
   fewer steps, the same digits of M3) */
#define GRANULATION__NOTHING 1e-20

/* One evaluation of the rates: the state, and arrays of b->work, all [n]. */
typedef struct granulation__flow {
    const double *y, *y_liquid, *y_air;        /* number, liquid (NULL with two components) and air of each cell */
    double *rate, *lost;                       /* dy/dt, and its last four numbers: what grows beyond the last pivot */
    double *loss, *selection;                  /* share that coalescence takes from a cell per second;
                                                  rate of breakage */
    double *active;                            /* y of the cells that coalesce, 0 of the others */
    double *born, *key0, *key1, *liquid, *air; /* sums over what forms in a cell: number, keys, liquid, air; cell
                                                  average only */
    bool one, fixed, carries;                  /* one component; fixed pivot; there is liquid or air to be carried */
} granulation__flow;

static inline granulation__flow granulation__flow_of(const granulation_balance *b, const double *y, double *rate) {
    size_t n = (size_t)b->n, length = granulation__length(b);
    granulation__flow f;
    f.one = b->components == 1;
    f.fixed = b->def.scheme == GRANULATION_FIXED_PIVOT;
    f.carries = b->total.l > 0.0 || b->total.a > 0.0;
    f.y = y;
    f.y_liquid = f.one ? y + n : NULL;
    f.y_air = f.one ? y + 2 * n : y + n;
    f.rate = rate;
    f.lost = rate + length - 4;
    f.loss = b->work + 4 * length;
    f.selection = f.loss + n;
    f.born = f.selection + n;
    f.key0 = f.born + n, f.key1 = f.born + 2 * n, f.liquid = f.born + 3 * n, f.air = f.born + 4 * n,
    f.active = f.born + 5 * n;
    memset(rate, 0, length * sizeof(double));
    memset(f.loss, 0, n * sizeof(double));
    if (!f.fixed) memset(f.born, 0, 5 * n * sizeof(double));
    return f;
}

/* Leaves out the far tail, whose fast losses would dictate the step. */
static inline void granulation__find_active(const granulation_balance *b, const granulation__flow *f) {
    double zeroth = 0.0, second = 0.0;
    for (int i = 0; i < b->n; i++) {
        double v = b->pivot[0][i % b->size[0]] + (f->one ? 0.0 : b->pivot[1][i / b->size[0]]);
        f->active[i] = f->y[i] * v * v;
        second += f->active[i];
        zeroth += f->y[i];
    }
    for (int i = 0; i < b->n; i++)
        f->active[i] =
            f->y[i] > GRANULATION__NOTHING * zeroth || f->active[i] > GRANULATION__NOTHING * second ? f->y[i] : 0.0;
}

/* Adds what pair p forms at the rate r: keys x, z, liquid l and air a of the new granule. */
static inline void granulation__form(const granulation_balance *b, const granulation__flow *f, size_t p, double r,
                                     double x, double z, double l, double a) {
    int t = b->target[p];
    if (t < 0) {
        f->lost[0] += r;
        f->lost[1] += r * (f->one ? x - l : x);
        f->lost[2] += r * l;
        f->lost[3] += r * a;
    } else if (!f->fixed) {
        f->born[t] += r;
        f->key0[t] += r * x;
        f->key1[t] += r * z;
        f->liquid[t] += r * l;
        f->air[t] += r * a;
    } else if (f->one && !f->carries) {
        double share = b->share[p];
        f->rate[t] += r * (1.0 - share);
        if (share > 0.0) f->rate[t + 1] += r * share;
    } else {
        granulation__place_of place;
        place.cell = t;
        place.f[0] = b->share[p * (size_t)b->components];
        place.f[1] = f->one ? 0.0 : b->share[p * 2 + 1];
        granulation__deposit(b, f->rate, &place, r, r * l, r * a);
    }
}

/* Adds the coalescence of all pairs of active cells. */
static inline void granulation__coalesce_cells(const granulation_balance *b, const granulation__flow *f) {
    const double *active = f->active;
    size_t p = 0;
    for (int i = 0; i < b->n; i++) {
        double y_i = active[i], own_loss = 0.0;
        if (!(y_i > 0.0)) {
            p += (size_t)(b->n - i);
            continue;
        }
        double x_i = b->pivot[0][i % b->size[0]], z_i = f->one ? 0.0 : b->pivot[1][i / b->size[0]];
        double l_i = f->one ? f->y_liquid[i] / y_i : z_i, a_i = f->y_air[i] / y_i;
        for (int j = i; j < b->n; j++, p++) {
            double k = b->kernel[p], y_j = active[j];
            if (!(k * y_j > 0.0)) continue;
            own_loss += k * y_j;
            if (j != i) f->loss[j] += k * y_i;
            double r = k * y_i * y_j;
            if (j == i) r *= 0.5;
            int j0 = f->one ? j : j % b->size[0], j1 = f->one ? 0 : j / b->size[0];
            double x = x_i + b->pivot[0][j0], z = f->one ? 0.0 : z_i + b->pivot[1][j1], l = z, a = 0.0;
            if (f->carries) {
                if (f->one) l = l_i + f->y_liquid[j] / y_j;
                a = a_i + f->y_air[j] / y_j;
            }
            granulation__form(b, f, p, r, x, z, l, a);
        }
        f->loss[i] += own_loss;
    }
}

/* Gives everything formed in a cell to the pivots around its mean (cell average). */
static inline void granulation__give_births(const granulation_balance *b, const granulation__flow *f) {
    for (int i = 0; i < b->n; i++) {
        if (!(f->born[i] > 0.0)) continue;
        double mean0 = granulation__mean_key(b, 0, i % b->size[0], f->key0[i], f->born[i]);
        double mean1 = f->one ? 0.0 : granulation__mean_key(b, 1, i / b->size[0], f->key1[i], f->born[i]);
        granulation__place_of place = granulation__share(b, mean0, mean1);
        granulation__deposit(b, f->rate, &place, f->born[i], f->liquid[i], f->air[i]);
    }
}

/* Adds the daughters of breakage into two of uniform volume: the hat functions of the pivots integrated over
   b(v|u) = 2/u, which is (x[i+1] - x[i-1]) / u below u, (u - x[i-1]) / u at u. */
static inline void granulation__break_uniformly(const granulation_balance *b, const granulation__flow *f) {
    const double *x = b->pivot[0];
    size_t n = (size_t)b->n;
    double above = 0.0, above_l = 0.0, above_a = 0.0; /* sums over all larger mothers */
    for (int i = b->n - 1; i >= 0; i--) {
        double per = f->selection[i] / x[i], left = i > 0 ? x[i - 1] : 0.0,
               width = i < b->n - 1 ? x[i + 1] - left : 0.0, own = x[i] - left;
        f->rate[i] += width * above + own * per * f->y[i];
        f->rate[n + (size_t)i] += x[i] * (width * above_l + own * per / x[i] * f->y_liquid[i]);
        f->rate[2 * n + (size_t)i] += x[i] * (width * above_a + own * per / x[i] * f->y_air[i]);
        above += per * f->y[i];
        above_l += per / x[i] * f->y_liquid[i];
        above_a += per / x[i] * f->y_air[i];
    }
}

/* Adds the daughters of breakage into halves. */
static inline void granulation__break_into_halves(const granulation_balance *b, const granulation__flow *f) {
    for (int i = 0; i < b->n; i++) {
        double r = f->selection[i] * f->y[i];
        if (!(r > 0.0)) continue;
        granulation__place_of place = granulation__halves(b, i);
        granulation__deposit(b, f->rate, &place, 2.0 * r, f->one ? f->selection[i] * f->y_liquid[i] : 0.0,
                             f->selection[i] * f->y_air[i]);
    }
}

/* Adds the daughters of breakage by a function of the caller's; liquid and air go with the volume. */
static inline void granulation__break_as_given(const granulation_balance *b, const granulation__flow *f) {
    const double *x = b->pivot[0];
    size_t n = (size_t)b->n;
    for (size_t mother = 0; mother < n; mother++) {
        const double *born = b->births + mother * (mother + 1) / 2, rate = f->selection[mother],
                     r = rate * f->y[mother];
        if (!(r > 0.0)) continue;
        for (size_t i = 0; i <= mother; i++) f->rate[i] += r * born[i];
        for (size_t i = 0; i <= mother && f->carries; i++) {
            const double share = rate * born[i] * x[i] / x[mother];
            f->rate[n + i] += share * f->y_liquid[mother], f->rate[2 * n + i] += share * f->y_air[mother];
        }
    }
}

/* Takes what coalesces and breaks from its cells. Returns the largest share that any cell loses per second. */
static inline double granulation__take_losses(const granulation_balance *b, const granulation__flow *f) {
    size_t n = (size_t)b->n;
    double largest = 0.0;
    for (size_t i = 0; i < n; i++) {
        double all = f->loss[i] + (b->def.selection ? f->selection[i] : 0.0);
        for (int k = 0; k < granulation__fields(b); k++) f->rate[(size_t)k * n + i] -= all * f->y[(size_t)k * n + i];
        if (all > largest) largest = all;
    }
    return largest;
}

/* Computes dy/dt of the state y. Returns the largest share that any cell loses per second. */
static inline double granulation__rates(const granulation_balance *b, const double *y, double *rate) {
    granulation__flow f = granulation__flow_of(b, y, rate);
    granulation__find_active(b, &f);
    if (b->def.kernel) granulation__coalesce_cells(b, &f);
    if (!f.fixed) granulation__give_births(b, &f);
    if (b->def.selection && b->def.daughters == GRANULATION_UNIFORM) granulation__break_uniformly(b, &f);
    else if (b->def.selection && b->def.daughters == GRANULATION_OWN) granulation__break_as_given(b, &f);
    else if (b->def.selection) granulation__break_into_halves(b, &f);
    return granulation__take_losses(b, &f);
}

static inline void granulation__consolidate_cells(granulation_balance *b, double *y, double decay) {
    double *air = b->components == 1 ? y + 2 * (size_t)b->n : y + b->n;
    for (int i = 0; i < b->n; i++) {
        double wet = b->pivot[0][i % b->size[0]] + (b->components == 2 ? b->pivot[1][i / b->size[0]] : 0.0);
        wet *= y[i];
        if (!(wet > 0.0)) continue;
        air[i] = granulation__consolidated(wet, air[i], decay);
    }
}

static inline double granulation__air_in(const granulation_balance *b, const double *y) {
    const double *air = b->components == 1 ? y + 2 * (size_t)b->n : y + b->n;
    double sum = 0.0;
    for (int i = 0; i < b->n; i++) sum += air[i];
    return sum;
}

/* Returns the largest of the relative errors of the moments 0, 1, 2 in the key volume, and of the carried totals. */
static inline double granulation__error(const granulation_balance *b, const double *fine, const double *coarse) {
    double e[3] = {0.0, 0.0, 0.0}, m[3] = {0.0, 0.0, 0.0}, worst = 0.0, all = 0.0;
    for (int i = 0; i < b->n; i++) {
        double v = b->pivot[0][i % b->size[0]] + (b->components == 2 ? b->pivot[1][i / b->size[0]] : 0.0),
               d = fabs(fine[i] - coarse[i]), y = fine[i];
        v /= b->pivot[0][b->size[0] - 1];
        for (int k = 0; k < 3; k++, d *= v, y *= v) {
            e[k] += d;
            m[k] += y;
        }
    }
    for (int k = 0; k < 3; k++) {
        if (m[k] > 0.0 && e[k] > worst * m[k]) worst = e[k] / m[k];
        all += e[k] + m[k];
    }
    for (int f = 1; f < granulation__fields(b); f++) {
        double d = 0.0, y = 0.0;
        for (int i = 0; i < b->n; i++) {
            d += fabs(fine[f * b->n + i] - coarse[f * b->n + i]);
            y += fine[f * b->n + i];
        }
        if (y > 0.0 && d > worst * y) worst = d / y;
        all += d + y;
    }
    return all < HUGE_VAL ? worst : HUGE_VAL; /* products that overflow are no small error */
}

/* Advances the balance by the third-order strong-stability-preserving Runge-Kutta method (Shu and Osher 1988) with its
   second-order companion as error estimate. Each stage is a mean of Euler steps, so that no cell can become negative
   while step times loss stays below 1; this is checked, and the step halved otherwise. */
GRANULATION_API granulation_status granulation_balance_run(granulation_balance *b, double duration) {
    if (!b || !b->state || !(duration >= 0.0 && b->time + duration < HUGE_VAL)) return GRANULATION_BAD_ARGUMENT;
    size_t length = granulation__length(b);
    double *base = b->work, *stage = base + length, *two = stage + length, *rate = two + length, *y = b->state;
    const double start = b->time; /* a late clock rounds, so the remaining time is counted from here */
    double gone = 0.0, allowed = b->def.most_lost * b->total.s;
    bool stale = b->next_step < 0.0 || b->def.kernel_changes;
    if (stale) {
        granulation_status status = granulation__evaluate_kernel(b);
        if (status != GRANULATION_OK) return status;
        if (b->next_step < 0.0) b->next_step = 0.0;
    }
    for (int tries = 0; gone < duration; tries++) {
        if (tries >= b->def.most_steps) return GRANULATION_STEP;
        double left = duration - gone, fastest = granulation__rates(b, y, rate), h = b->next_step;
        if (!(h > 0.0)) h = fastest > 0.0 ? 0.01 / fastest : left;
        if (h * fastest > 0.9) h = 0.9 / fastest;
        if (h > b->def.longest_step) h = b->def.longest_step;
        bool last = h >= left;
        if (last) h = left;
        if (!last && h > 0.5 * left) h = 0.5 * left; /* no sliver at the end */
        if (!last && gone + h == gone) return GRANULATION_STEP;
        double half = b->def.consolidation > 0.0 ? riddle_exp(-0.5 * b->def.consolidation * h) : 1.0;
        memcpy(base, y, length * sizeof(double));
        if (half < 1.0) {
            granulation__consolidate_cells(b, base, half);
            fastest = granulation__rates(b, base, rate);
        }
        for (size_t k = 0; k < length; k++) stage[k] = base[k] + h * rate[k];
        double loss1 = granulation__rates(b, stage, rate);
        for (size_t k = 0; k < length; k++) {
            double euler = stage[k] + h * rate[k];
            two[k] = 0.5 * base[k] + 0.5 * euler;
            stage[k] = 0.75 * base[k] + 0.25 * euler;
        }
        double loss2 = granulation__rates(b, stage, rate);
        for (size_t k = 0; k < length; k++) stage[k] = base[k] / 3.0 + 2.0 / 3.0 * (stage[k] + h * rate[k]);
        double error = granulation__error(b, stage, two), scale = b->def.tolerance / (error > 1e-300 ? error : 1e-300);
        double factor = scale > 1e3 ? 5.0 : 0.9 * riddle_cbrt(scale);
        factor = factor < 5.0 ? (factor > 0.2 ? factor : 0.2) : 5.0;
        if (!(error <= b->def.tolerance) || h * loss1 > 0.95 || h * loss2 > 0.95) {
            b->next_step = h * (factor < 0.9 ? factor : 0.5);
            b->refused++;
            if (!(b->next_step > 0.0)) return GRANULATION_STEP;
            continue;
        }
        double before = granulation__air_in(b, stage), air_base = granulation__air_in(b, base),
               air_old = granulation__air_in(b, y);
        if (half < 1.0) granulation__consolidate_cells(b, stage, half);
        b->air_released += (air_old - air_base) + (before - granulation__air_in(b, stage));
        memcpy(y, stage, length * sizeof(double));
        b->lost_number = y[length - 4];
        b->lost.s = y[length - 3];
        b->lost.l = y[length - 2];
        b->lost.a = y[length - 1];
        gone = last ? duration : gone + h;
        b->time = start + gone;
        b->steps++;
        if (!last || h * factor < b->next_step || b->next_step == 0.0) b->next_step = h * factor;
        if (b->lost.s > allowed) return GRANULATION_GEL;
        if (b->def.kernel_changes && gone < duration) {
            granulation_status status = granulation__evaluate_kernel(b);
            if (status != GRANULATION_OK) return status;
        }
    }
    return GRANULATION_OK;
}

/* ---- properties of the population ---- */

GRANULATION_API double granulation_balance_number(const granulation_balance *b, int cell) {
    return b && b->state && cell >= 0 && cell < b->n ? b->number[cell] : (double)NAN;
}

GRANULATION_API double granulation_balance_moment(const granulation_balance *b, double p, double q) {
    if (!b || !b->state || !(p >= 0.0 && q >= 0.0) || (b->components == 1 && q != 0.0)) return (double)NAN;
    double sum = 0.0;
    for (int j = 0; j < b->size[1]; j++) {
        double row = 0.0, z = b->components == 2 ? b->pivot[1][j] : 1.0;
        for (int i = 0; i < b->size[0]; i++) {
            double x = b->pivot[0][i];
            row += b->number[i + b->size[0] * j] * (p == 1.0   ? x
                                                    : p == 2.0 ? x * x
                                                    : p == 3.0 ? x * x * x
                                                               : riddle_pow(x, p));
        }
        sum += row * (q == 0.0 ? 1.0 : z > 0.0 ? riddle_pow(z, q) : 0.0);
    }
    return sum;
}

GRANULATION_API granulation_granule granulation_balance_totals(const granulation_balance *b) {
    granulation_granule t = {0.0, 0.0, 0.0};
    for (int i = 0; b && i < b->n; i++) {
        double count = b->number[i], key = b->pivot[0][i % b->size[0]];
        t.l += b->components == 1 ? b->liquid[i] : count * b->pivot[1][i / b->size[0]];
        t.s += b->components == 1 ? count * key - b->liquid[i] : count * key;
        t.a += b->air[i];
    }
    return t;
}

GRANULATION_API double granulation_balance_mean(const granulation_balance *b, int p, int q) {
    if (!b || !b->state || q < 0 || q >= p || p > 6) return (double)NAN;
    double above = 0.0, below = 0.0, unit = granulation_diameter(b->pivot[0][b->size[0] - 1]);
    for (int i = 0; i < b->n; i++) {
        if (!(b->number[i] > 0.0)) continue;
        granulation_granule g = granulation_balance_cell(b, i);
        double d = granulation_diameter(granulation_volume(&g)) / unit;
        above += b->number[i] * granulation__power(d, p);
        below += b->number[i] * granulation__power(d, q);
    }
    return unit * granulation__mean_of(above, below, p - q);
}

/* ==== >>montecarlo ==== */

static inline bool granulation__raise(granulation_montecarlo *mc, const granulation_granule *i,
                                      const granulation_granule *j) {
    double k = mc->kernel(i, j, mc->user);
    if (!(k >= 0.0 && k < HUGE_VAL)) return false;
    if (k > mc->bound) mc->bound = k;
    return true;
}
/* Raises the bound of the kernel by granule g with the smallest and the largest ever present and with itself: right for
   kernels that grow with either size or with the contrast of the two. Any other kernel raises the bound when a
   pair exceeds it. */
static inline bool granulation__bound(granulation_montecarlo *mc, const granulation_granule *g) {
    double v = granulation_volume(g);
    if (v < granulation_volume(&mc->smallest)) mc->smallest = *g;
    if (v > granulation_volume(&mc->largest)) mc->largest = *g;
    return granulation__raise(mc, g, &mc->smallest) && granulation__raise(mc, g, &mc->largest) &&
           granulation__raise(mc, g, g);
}

GRANULATION_API granulation_status granulation_montecarlo_init(granulation_montecarlo *mc,
                                                               const granulation_granule *sample, int n, double volume,
                                                               granulation_kernel kernel, const void *user,
                                                               uint64_t seed, const granulation_memory *memory) {
    if (!mc) return GRANULATION_BAD_ARGUMENT;
    memset(mc, 0, sizeof *mc);
    if (!sample || n < 2 || !(volume > 0.0 && volume < HUGE_VAL) || !kernel) return GRANULATION_BAD_ARGUMENT;
    for (int i = 0; i < n; i++)
        if (!granulation__is_granule(sample + i)) return GRANULATION_BAD_ARGUMENT;
    if (memory) mc->memory = *memory;
    mc->granules = (granulation_granule *)granulation__memory(&mc->memory, NULL, 0, (size_t)n * sizeof *sample);
    if (!mc->granules) return GRANULATION_NO_MEMORY;
    memcpy(mc->granules, sample, (size_t)n * sizeof *sample);
    mc->n = n;
    mc->volume = volume;
    mc->kernel = kernel;
    mc->user = user;
    mc->random = granulation_random_seed(seed);
    mc->smallest = mc->largest = sample[0];
    for (int i = 0; i < n; i++)
        if (!granulation__bound(mc, mc->granules + i)) {
            granulation_montecarlo_free(mc);
            return GRANULATION_KERNEL;
        }
    return GRANULATION_OK;
}

GRANULATION_API void granulation_montecarlo_free(granulation_montecarlo *mc) {
    if (!mc) return;
    granulation__memory(&mc->memory, mc->granules, mc->granules ? (size_t)mc->n * sizeof *mc->granules : 0, 0);
    memset(mc, 0, sizeof *mc);
}

GRANULATION_API granulation_status granulation_montecarlo_run(granulation_montecarlo *mc, double duration) {
    if (!mc || !mc->granules || !(duration >= 0.0 && mc->time + duration < HUGE_VAL)) return GRANULATION_BAD_ARGUMENT;
    const double most = 1e9, n = mc->n, start = mc->time;
    double gone = 0.0;
    for (int64_t proposals = 0; mc->bound > 0.0; proposals++) {
        const double rate = mc->bound * (0.5 * n * (n - 1.0) / mc->volume);
        /* too many proposals: refused before any is drawn */
        if (!((duration - gone) * rate <= most)) return GRANULATION_STEP;
        if (proposals > INT64_C(1000000000)) return GRANULATION_STEP;
        double wait = -riddle_log(1.0 - granulation_random_uniform(&mc->random)) / rate;
        if (!(gone + wait < duration)) break;
        gone += wait;
        mc->time = start + gone;
        int i = (int)(n * granulation_random_uniform(&mc->random)),
            j = (int)((n - 1.0) * granulation_random_uniform(&mc->random));
        if (j >= i) j++;
        double k = mc->kernel(mc->granules + i, mc->granules + j, mc->user);
        if (!(k >= 0.0 && k < HUGE_VAL)) return GRANULATION_KERNEL;
        if (k > mc->bound) {
            mc->bound = k;
            mc->raised++;
        }
        if (granulation_random_uniform(&mc->random) * mc->bound >= k) continue;
        mc->granules[i] = granulation_sum(mc->granules + i, mc->granules + j);
        /* the copy fills the place of j; any of the others, the new granule too */
        int copy = (int)((n - 1.0) * granulation_random_uniform(&mc->random));
        if (copy >= j) copy++;
        mc->granules[j] = mc->granules[copy];
        mc->volume *= n / (n - 1.0);
        mc->events++;
        if (!(mc->volume < HUGE_VAL)) return GRANULATION_STEP;
        if (!granulation__bound(mc, mc->granules + i)) return GRANULATION_KERNEL;
    }
    mc->time = start + duration;
    return GRANULATION_OK;
}

GRANULATION_API double granulation_montecarlo_moment(const granulation_montecarlo *mc, double p) {
    if (!mc || !mc->granules || !(p >= 0.0)) return (double)NAN;
    double sum = 0.0;
    for (int i = 0; i < mc->n; i++) {
        double v = granulation_volume(mc->granules + i);
        sum += p == 0.0 ? 1.0 : p == 1.0 ? v : p == 2.0 ? v * v : riddle_pow(v, p);
    }
    return sum / mc->volume;
}

GRANULATION_API granulation_status granulation_range(const double *values, int n, double *mean, double *low,
                                                     double *high) {
    double sum = 0.0, squares = 0.0;
    if (mean) *mean = (double)NAN;
    if (low) *low = (double)NAN;
    if (high) *high = (double)NAN;
    if (!values || n < 2) return GRANULATION_BAD_ARGUMENT;
    for (int i = 0; i < n; i++) {
        if (!(fabs(values[i]) < HUGE_VAL)) return GRANULATION_BAD_ARGUMENT;
        sum += values[i] / n;
    }
    for (int i = 0; i < n; i++) squares += (values[i] - sum) * (values[i] - sum);
    const double reach = riddle_student(0.95, n - 1.0) * sqrt(squares / ((n - 1.0) * n));
    if (mean) *mean = sum;
    if (low) *low = sum - reach;
    if (high) *high = sum + reach;
    return GRANULATION_OK;
}

#endif /* GRANULATION__BODIES */

#undef GRANULATION__ENUM
#ifdef __cplusplus
}
#endif
#endif
