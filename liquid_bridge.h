/* liquid_bridge.h: forces of pendular liquid bridges between spheres, plates and wires, and who has which liquid.

       #include "liquid_bridge.h"
       #include <stdio.h>

       // a 2.5 mm sphere is pulled off a plate, water between
       int main(void) {
           bridge_pair_def def = bridge_pair_default_def();                // every field has a documented default
           bridge_pair     pair;
           bridge          b;                                              // twelve doubles
           def.radius_j = INFINITY;                                        // a plate, or a wire
           // once per kind of pair: Young-Laplace, solved, tabulated
           if (bridge_pair_prepare(&pair, &def) != BRIDGE_OK) return 1;
           // at contact: liquid given by i and by j [m3]
           bridge_form(&pair, 2.5e-3, INFINITY, 1e-10, 0.0, 0, &b);
           for (double gap = 0.0; !bridge_is_ruptured(&b, &def.liquid, gap, 0.01); gap += 1e-5)
               // every step: + - * / sqrt only
               printf("%g m: %g N\n", gap, bridge_evaluate(&b, &def.liquid, gap, 0.01).normal);
       }

   What is in it: volume shares (Shi & McCarthy 2008; Elskamp & Kruggel-Emden 2019, eqs 7-11), capillary force (energy
   form; Willett et al. 2000, full and simple; Young-Laplace, solved), viscous force (Pitois et al. 2000 normal;
   bridge-limited Couette tangential; Goldman et al. 1967), rupture (Willett/Pitois static and dynamic; unequal contact
   angles; Young-Laplace), the neck split of the liquid, books with exact conservation, and the laws of eqs 12-20 word
   for word as printed in the 2019 paper (bridge_printed_*), which are wrong in places: docs/liquid_bridge.md says
   where.

   How: the meniscus without gravity is a Delaunay curve, known in closed form along its arc. bridge_pair_prepare solves
   it for ten volumes, each from contact to rupture, and keeps force, rupture distance and neck split as Chebyshev
   series in ln V. bridge_form contracts them to seven coefficients: F = X(S) (c0 + c1 tau + ... + c6 tau^6),
   tau = sqrt(S_rupture - S), X = a/(h (h + S)), h = sqrt(S^2 + a). Within 0.3 % of Young-Laplace, mostly 0.1 %;
   bridge_pair.deviation says what was measured for this very pair.

   Conventions: SI units, angles in radians. gap S = centre distance minus both radii; S < 0 is overlap, where capillary
   forces are those of contact (S = 0). velocity = rate of change of the gap, > 0 separating. Forces are positive when
   they pull the two solids together. Two effective radii, never mixed: harmonic R_h = 2 ri rj/(ri + rj) (capillarity),
   reduced R_s = R_h/2 (viscosity); plate or wire: R_h = 2 ri, R_s = ri. a = 2 V/(pi R_h) [m2] is the only volume group
   in the neck laws. n points from j to i. Arms ai = bridge_arm(ri, rj, S), aj = D - ai. Slip v_s = v_t + n x (ai
   wi + aj wj) (with the arms, not the radii: a rigidly turning pair then slips not at all). Force on i:
   -n * normal - tangential * v_s; on j its opposite. Moments: on i -ai n x F_t, on j -aj n x F_t. So linear and angular
   momentum are kept to round-off and the viscous power is never positive.

   Memory: none is allocated. Threads: no state is shared; films are changed by bridge_allocate and bridge_release only.
   Determinism: + - * / sqrt, frexp, ldexp and the portable block; same bits on every machine with -ffp-contract=off.
   Not in it: gravity in the meniscus, evaporation kinetics, bridges that touch each other (bridge_pair.pendular_volume
   says when they do), contact-angle hysteresis, formation at a distance. */
#ifndef RIDDLE_LIQUID_BRIDGE_H
#define RIDDLE_LIQUID_BRIDGE_H

#include <math.h>
#include <stddef.h>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "liquid_bridge.h needs NaN and signed zero: compile without -ffast-math"
#endif
#ifndef BRIDGE_API
#define BRIDGE_API static inline
#define BRIDGE__BODIES
#elif defined(BRIDGE_IMPLEMENTATION)
#define BRIDGE__BODIES
#endif
/* Functions that a host's loop over bridges calls: inlined, so that the loop vectorises. */
#if defined(__GNUC__)
#define BRIDGE_INLINE static inline __attribute__((always_inline))
#elif defined(_MSC_VER)
#define BRIDGE_INLINE static __forceinline
#else
#define BRIDGE_INLINE static inline
#endif
#ifdef __cplusplus
extern "C" {
#endif

/* Terms in tau of a bridge's force, written out in bridge_attraction: 6 leave 0.25 %, 7 leave 0.11 %, 8 leave 0.07 %
   (V/R_h^3 >= 1e-7, angles to 45 degrees). */
#define BRIDGE_SERIES 7
#define BRIDGE_NODES 10 /* volumes solved per pair kind: five decades of V* to 0.01 % */
#define BRIDGE_PIECES 4 /* parts of the table about a jump of the neck; 1 where there is none */

/* >>status --------------------------------------------------------------------------------------------------------- */

#define BRIDGE_STATUSES(X)                                                                                             \
    X(BRIDGE_OK, "ok")                                                                                                 \
    X(BRIDGE_INVALID, "a parameter is outside its documented range")                                                   \
    X(BRIDGE_NO_SOLUTION, "no pendular bridge solves the Young-Laplace equation here")                                 \
    X(BRIDGE_RUPTURED, "the gap is beyond the rupture distance")                                                       \
    X(BRIDGE_VOLUME, "the volume is outside the range that the pair was prepared for")

typedef enum bridge_status {
#define BRIDGE__ENUM(name, text) name,
    BRIDGE_STATUSES(BRIDGE__ENUM)
#undef BRIDGE__ENUM
        BRIDGE_STATUS_COUNT
} bridge_status;

/* Returns a short English text; "unknown status" for a number that is none. Never NULL; not to be freed. */
static inline const char *bridge_status_text(bridge_status status);

/* >>types ---------------------------------------------------------------------------------------------------------- */

typedef struct bridge_liquid {
    double surface_tension; /* sigma [N/m], > 0; default 0.07275 (water, 20 C) */
    double viscosity;       /* eta, dynamic [Pa s], >= 0; default 1.002e-3 (water, 20 C); 0 switches
                               viscous forces off */
    double roughness;       /* smallest gap of the viscous laws over R_s [-], S_min = roughness * R_s, 2e-4 .. 0.1;
                               default 0.001 */
} bridge_liquid;

typedef enum bridge_split {
    BRIDGE_SPLIT_NECK,  /* cut at the neck of the meniscus at rupture, by Young-Laplace (default) */
    BRIDGE_SPLIT_HALF,  /* half each */
    BRIDGE_SPLIT_RETURN /* each solid gets back its contribution */
} bridge_split;

typedef struct bridge_pair_def {
    double radius_i;      /* [m], > 0; default 2.5e-3 */
    double radius_j;      /* [m], > 0, INFINITY for a plate or a wire; default 2.5e-3. radius_i/radius_j
                             from 1e-6 to 1e6 or 0 */
    double angle_i;       /* contact angle on i [rad], 0 .. 1.05 (60 degrees); default 0.2618 (glass, 15 degrees) */
    double angle_j;       /* contact angle on j [rad], 0 .. 1.05; default 0.2618. Spheres whose radii and angles
                             are equal to 1e-10 are solved as symmetric */
    double volume_min;    /* smallest V/R_h^3 of the table [-], 1e-8 .. volume_max/2; default 1e-6. Drier: no
                             bridge is formed */
    double volume_max;    /* largest V/R_h^3 of the table [-], <= 0.15; default 0.1 (beyond about 0.06 bridges meet:
                             pendular_volume) */
    bridge_liquid liquid; /* only its surface tension enters the table */
    bridge_split split;   /* where a rupture leaves the liquid; default BRIDGE_SPLIT_NECK */
    unsigned cookie;      /* set by bridge_pair_default_def; not to be changed */
} bridge_pair_def;

/* One kind of pair, prepared. Plain data of 1 kB: it may be copied; a scene has one for each of its
   kinds. Read only. */
typedef struct bridge_pair {
    bridge_pair_def def;      /* the definition that it was made of */
    double radius;            /* harmonic radius R_h of the def [m] */
    double pendular_volume;   /* V/R_h^3 at which the larger half-filling angle in contact reaches 30 degrees, so that
                                        the bridges of three touching spheres meet [-]; INFINITY if it stays below in
                                        the table's range */
    double deviation;         /* largest |series/Young-Laplace - 1| of the force at gaps to 0.9 of rupture [-]: 1.25
                                 times the largest found in preparation, at three volumes between each two nodes */
    double rupture_deviation; /* the same for the rupture gap [-] */
    double ln_min, ln_max;    /* range of ln(V/R_h^3) */
    int pieces;               /* 1, or BRIDGE_PIECES: solids of very different wetting have a volume (plate, 15 and 45
                                 degrees: V/R_h^3 = 0.026) at which the neck moves from one to the other; the table
                                 is cut there */
    /* Ends of the pieces in ln(V/R_h^3), ln_edge[pieces] the last. */
    double ln_edge[BRIDGE_PIECES + 1];
    /* Chebyshev coefficients in ln V: force series, ln(S_rup/V^(1/3)), neck split. */
    double table[BRIDGE_PIECES][BRIDGE_SERIES + 2][BRIDGE_NODES];
    unsigned cookie;
} bridge_pair;

/* One bridge: 12 doubles, which the caller keeps with the pair. volume = 0: no bridge. */
typedef struct bridge {
    double volume;                /* V [m3] */
    double width;                 /* sqrt(a) = sqrt(2 V/(pi R_h)) [m] */
    double rupture_gap;           /* static rupture distance [m] */
    double radius;                /* harmonic radius R_h of this pair [m] */
    double split;                 /* fraction of V that goes to i at rupture [-], 0 .. 1 */
    double series[BRIDGE_SERIES]; /* c_k [N/m^(k/2)]: F = X(S) sum c_k tau^k, tau = sqrt(max(0, rupture_gap - S)) */
} bridge;

typedef struct bridge_forces {
    double normal;     /* capillary attraction plus viscous resistance [N], > 0 pulls together */
    double tangential; /* resistance to the translation part v_t of the slip [N s/m] */
    double spin; /* resistance to the rotation part n x (ai wi + aj wj) of the slip [N s/m]; equal to `tangential` in
                    bridge_evaluate */
} bridge_forces;

/* Viscous resistances of a bridge [N s/m], >= 0. */
typedef struct bridge_resistances {
    double normal;     /* to separation and approach */
    double tangential; /* to slip, its translation and its rotation part alike */
} bridge_resistances;

/* One Young-Laplace solution. */
typedef struct bridge_shape {
    double force;                /* attraction [N], the same at every section of the liquid */
    double pressure;             /* in the liquid minus outside [Pa]; negative: suction */
    double gap;                  /* [m] */
    double neck;                 /* radius of the meniscus where it is parallel to the axis [m] */
    double ring_i, ring_j;       /* radius of the wetted circle on i, on j [m] */
    double filling_i, filling_j; /* half-filling angle on i, on j [rad]; 0 on a plate */
    double share_i;              /* volume on i's side of the neck over V [-], 0 .. 1 (0 or 1: the thinnest section
                                    is at a solid) */
    double energy;               /* free surface energy against the dry solids [J]; force = d energy/d gap at
                                    constant volume */
    int stable;                  /* 0 for the symmetric solution of two equal spheres beyond its first
                                    instability, else 1 */
} bridge_shape;

/* >>laws-list: pure functions of scalars; NaN outside the stated domain -------------------------------------------- */

/* Unless a line says otherwise: gap S >= 0 [m]; volume V > 0 [m3]; radii > 0 [m]; contact angles 0 .. pi/2 [rad];
   surface_tension > 0 [N/m]; viscosity >= 0 [Pa s]; viscous_gap > 0 [m]; velocity [m/s], > 0 separating. Films, shares
   and volumes may be 0. */

/* Returns R_h = 2 ri rj/(ri + rj) [m]; ri, rj > 0, INFINITY allowed for one (plate, wire: 2 ri). */
static inline double bridge_harmonic_radius(double ri, double rj);
/* Returns R_s = ri rj/(ri + rj) [m] = R_h/2. */
static inline double bridge_reduced_radius(double ri, double rj);
/* Returns a = 2 V/(pi R_h) [m2], V >= 0 [m3], R_h > 0 [m]. */
static inline double bridge_neck_area(double volume, double harmonic_radius);
/* Returns X = 1 - S/sqrt(S^2 + a) [-], 0 .. 1, without cancellation; gap S >= 0 [m], a >= 0 [m2]; 0 without liquid. */
static inline double bridge_neck_factor(double gap, double neck_area);
/* Returns the lever arm of i [m]: ri D/(ri + rj) = ri (1 + S/(ri + rj)). The arm of j is bridge_arm(rj, ri, S); they
   add up to D. On a plate: ri. */
static inline double bridge_arm(double ri, double rj, double gap);

/* Returns the liquid [m3] that sphere i gives to a bridge with sphere j from its film L [m3]: the film on the cap that
   sees j (Shi & McCarthy 2008; eq 7). */
static inline double bridge_share_sphere(double film_i, double ri, double rj);
/* Returns the liquid [m3] that a sphere gives to a bridge with a plate (eq 8): the share of an equal sphere, not the
   limit rj -> infinity, which is L/2. */
static inline double bridge_share_wall(double film_i);
/* Returns the liquid [m3] that a wall's film of thickness W [m] gives to a sphere (eq 9). */
static inline double bridge_share_wall_film(double thickness, double ri);
/* Returns the liquid [m3] that a sphere gives to a wire of radius rw [m] (eq 10), rw <= 6 ri. */
static inline double bridge_share_wire(double film_i, double ri, double rw);
/* Returns the liquid [m3] that a wire's film of thickness W [m] gives to a sphere (eq 11). */
static inline double bridge_share_wire_film(double thickness, double ri, double rw);

/* Returns the half-filling angle between spheres (eq 14) [rad], by the parabolic gap; meant for angles below 0.5.
   S >= 0, V >= 0. */
static inline double bridge_filling_angle(double gap, double volume, double harmonic_radius);
/* Returns the half-filling angle of a sphere on a plate (eq 15, corrected) [rad]. */
static inline double bridge_filling_angle_plate(double gap, double volume, double radius);
/* Returns the angle whose cosine is the mean of both cosines [rad]: the right mean for the force of unequal contact
   angles (not for rupture). */
static inline double bridge_effective_angle(double angle_i, double angle_j);

/* Returns the capillary force [N], energy form pi sigma R_h (cos i + cos j) X (eq 12 without its tension term;
   Derjaguin). S >= 0. Plate: R_h = 2 r. Too strong at contact (4 .. 30 %), too weak near rupture (-30 %):
   for estimates. */
static inline double bridge_force_energy(double gap, double volume, double harmonic_radius, double angle_i,
                                         double angle_j, double surface_tension);
/* Returns the slope dF/dS of bridge_force_energy [N/m], < 0. */
static inline double bridge_stiffness_energy(double gap, double volume, double harmonic_radius, double angle_i,
                                             double angle_j, double surface_tension);
/* Returns the work [J] to open from contact to gap S against bridge_force_energy. */
static inline double bridge_work_energy(double gap, double volume, double harmonic_radius, double angle_i,
                                        double angle_j, double surface_tension);
/* Returns the capillary force [N] as the paper intended it: energy form plus surface tension on the wetted ring (eq 12,
   corrected). It counts the tension twice and is 20 .. 70 % too strong. Two spheres. */
static inline double bridge_force_tension(double gap, double volume, double harmonic_radius, double angle_i,
                                          double angle_j, double surface_tension);
/* Returns the same for a sphere of `radius` on a plate (eq 13, corrected). */
static inline double bridge_force_tension_plate(double gap, double volume, double radius, double angle_i,
                                                double angle_j, double surface_tension);
/* Returns the capillary force [N], full fit of Willett et al. 2000, mean contact angle [rad] up to 50
   degrees, 5e-5 <= V/R_h^3 <= 0.2. Error 1 .. 3 % to half of rupture, 10 % at 0.95. */
static inline double bridge_force_willett(double gap, double volume, double harmonic_radius, double angle,
                                          double surface_tension);
/* Returns the capillary force [N], simple rational fit of Willett et al. 2000: pi sigma R_h (cos i + cos j)/(1 + 1.05
   s + 2.5 s^2), s = S sqrt(R_h/V). Up to 40 % off. */
static inline double bridge_force_willett_simple(double gap, double volume, double harmonic_radius, double angle_i,
                                                 double angle_j, double surface_tension);

/* Returns the gap for the viscous laws [m]: max(S, 0) + roughness * R_s. */
BRIDGE_INLINE double bridge_viscous_gap(double gap, double reduced_radius, double roughness);
/* Returns the normal viscous resistance [N s/m] (eq 16; Pitois et al. 2000): 6 pi eta R_s^2 X^2/S_v; S_v > 0 from
   bridge_viscous_gap. */
static inline double bridge_drag_normal(double viscous_gap, double volume, double reduced_radius, double viscosity);
/* Returns the tangential viscous resistance [N s/m] per slip: Couette flow over the wetted disc, pi eta R_s
   ln(1 + a/S_v^2). Objective and passive. */
static inline double bridge_drag_tangential(double viscous_gap, double volume, double reduced_radius, double viscosity);
/* Return resistance functions [-] of one sphere near a wall (Goldman et al. 1967), x = S/R > 0; near: x < 0.1, far:
   x >= 0.1 (both can be evaluated at any x > 0): translation f_t, coupling f_r, rotation f_rr. Force = -6 pi eta R (f_t
   U - f_r R W), moment/R = -6 pi eta R (f_rr R W - f_r U). */
static inline double bridge_goldman_translation_near(double x);
static inline double bridge_goldman_translation_far(double x);
static inline double bridge_goldman_coupling_near(double x);
static inline double bridge_goldman_coupling_far(double x);
static inline double bridge_goldman_rotation(double x);

/* Returns the static rupture distance [m] (eq 19; Willett et al. 2000, Pitois et al. 2001): angles [rad],
   radius_ratio = small/large in 0 .. 1 (plate 0), R_h harmonic, V/R_h^3 0 .. 15. rms 2.5 % of Young-Laplace for equal
   angles, 18 % for unequal ones. */
static inline double bridge_rupture_gap(double volume, double harmonic_radius, double radius_ratio, double angle_i,
                                        double angle_j);
/* Returns the same within 1 % rms and 4 % at most of Young-Laplace, for angles to 50 degrees, equal or not, any
   radius_ratio, V/R_h^3 from 1e-6 to 0.1: eq 19 times a factor, the smaller of two cubics in the exponent, for the
   bridge lets go of one sphere or of the other (fitted to 12 000 bridges, compared with 7000 others:
   tests/fit_rupture_gap.c). angle_small: on the smaller sphere. Beyond this range the factor is that of its end. A
   prepared pair is nearer (0.16 % rms), but off by up to 3 % where a plate's neck jumps (angles 30, 45). */
static inline double bridge_rupture_gap_unequal(double volume, double harmonic_radius, double radius_ratio,
                                                double angle_small, double angle_large);
/* Returns the dynamic rupture distance [m] (eq 20; Pitois et al. 2001): S_rup (1 + sqrt(Ca)), Ca = eta max(0,
   velocity)/sigma. */
static inline double bridge_rupture_gap_dynamic(double rupture_gap, double velocity, double surface_tension,
                                                double viscosity);

/* Returns the impact speed [m/s] below which a wet collision sticks: sqrt(2 W/m)/e; W [J] the work to rupture, m [kg]
   the reduced mass, e in (0, 1]. */
static inline double bridge_sticking_velocity(double work, double reduced_mass, double restitution);
/* Returns the wet restitution [-]: sqrt(max(0, e^2 - 2 W/(m v^2))), v > 0 the impact speed [m/s]. The bridge forms in
   contact and costs W once, on the way out; no viscosity. */
static inline double bridge_wet_restitution(double work, double reduced_mass, double restitution, double velocity);

/* >>printed-list: eqs 12-20 of Elskamp & Kruggel-Emden 2019 as they stand in print. For comparison; they
   are not right. */

/* Returns the capillary force between spheres (eq 12) [N]: second term with sin(theta) where the ring angle belongs. */
static inline double bridge_printed_force(double gap, double volume, double harmonic_radius, double angle_i,
                                          double angle_j, double surface_tension);
/* Returns the capillary force of a sphere on a wall (eq 13) [N]. */
static inline double bridge_printed_force_wall(double gap, double volume, double radius, double angle_i, double angle_w,
                                               double surface_tension);
/* Returns the half-filling angle of a sphere on a wall (eq 15) [rad], without the "-1 +". (Eq 14 is right:
   bridge_filling_angle.) */
static inline double bridge_printed_filling_angle_wall(double gap, double volume, double radius);
/* Returns the tangential resistance to v_t [N s/m] (eqs 17, 18): the same near-field term in both; negative
   beyond 6.036 R_s. S_v > 0. */
static inline double bridge_printed_drag_translation(double viscous_gap, double reduced_radius, double viscosity);
/* Returns the tangential resistance to n x (ri wi + rj wj) [N s/m] (eqs 17, 18), for the n (j to i) of eqs 4 and 12:
   negative, the sign erratum. */
static inline double bridge_printed_drag_spin(double viscous_gap, double reduced_radius, double viscosity);

/* >>pair-list ------------------------------------------------------------------------------------------------------ */

/* Returns valid defaults: two 5 mm glass spheres, water. */
BRIDGE_API bridge_pair_def bridge_pair_default_def(void);
/* Returns BRIDGE_OK, or BRIDGE_INVALID with *field (may be NULL) the name of the first bad field, NULL when
   all is well. */
BRIDGE_API bridge_status bridge_pair_check_def(const bridge_pair_def *def, const char **field);
/* Solves and tabulates one kind of pair (10 to 20 milliseconds; nearly equal spheres over 30 degrees 60, with a jump of
   the neck 150). BRIDGE_INVALID, or BRIDGE_NO_SOLUTION if some volume of the range has no bridge in contact;
   *pair is then unusable. */
BRIDGE_API bridge_status bridge_pair_prepare(bridge_pair *pair, const bridge_pair_def *def);

/* Solves Young-Laplace for a bridge of `volume` [m3] at `gap` >= 0 [m] between the solids of def (its volume range is
   not read). Relative error about 1e-12. BRIDGE_RUPTURED beyond the last equilibrium. *shape is NaN after any
   failure, as below. */
BRIDGE_API bridge_status bridge_young_laplace(const bridge_pair_def *def, double volume, double gap,
                                              bridge_shape *shape);
/* Finds the last stable equilibrium: first instability (equal spheres, contact angle over about 30 degrees) or fold,
   whichever comes first. *fold_gap (may be NULL): the fold [m]. */
BRIDGE_API bridge_status bridge_young_laplace_rupture(const bridge_pair_def *def, double volume, bridge_shape *shape,
                                                      double *fold_gap);

/* Forms a bridge of the liquid given by i and j [m3] between solids of these radii [m]. The radii may differ from the
   def's: lengths scale with R_h (radii off by 2 % either way: force within 0.3 %, rupture gap within 0.6 %, tested).
   swapped: nonzero if the caller's i is the def's j. BRIDGE_VOLUME if the volume is outside the table (drier: no
   bridge; wetter: bridge_allocate caps it); then b->volume =
   0. */
BRIDGE_API bridge_status bridge_form(const bridge_pair *pair, double radius_i, double radius_j, double given_i,
                                     double given_j, int swapped, bridge *b);
/* Does the same for the paper's printed laws: rupture gap by eq 19 (bridge_evaluate_printed needs no series). */
BRIDGE_API bridge_status bridge_form_printed(const bridge_pair *pair, double radius_i, double radius_j, double given_i,
                                             double given_j, int swapped, bridge *b);
/* Computes the range of volumes that bridge_form accepts for these radii [m3]. */
BRIDGE_API void bridge_volume_range(const bridge_pair *pair, double radius_i, double radius_j, double *smallest,
                                    double *largest);
/* Returns 1 while the liquid is pendular (see pendular_volume), 0 beyond that: forces are then those of an isolated
   bridge, an overestimate. */
BRIDGE_API int bridge_is_pendular(const bridge_pair *pair, const bridge *b);

/* Quantities outside the range of a fit or of a table, where a law extrapolates. */
#define BRIDGE_OUTSIDES(X)                                                                                             \
    X(BRIDGE_OUTSIDE_WILLETT, 1,                                                                                       \
      "bridge_force_willett: fitted for a mean contact angle to 50 degrees and V/R_h^3 from 5e-5 to 0.2")              \
    X(BRIDGE_OUTSIDE_UNEQUAL, 2,                                                                                       \
      "bridge_rupture_gap_unequal: fitted for contact angles to 50 degrees and V/R_h^3 from 1e-6 to 0.1")              \
    X(BRIDGE_OUTSIDE_TABLE, 4, "bridge_form: the volume is outside the prepared table")                                \
    X(BRIDGE_OUTSIDE_RADII, 8,                                                                                         \
      "bridge_form: the ratio of the radii is off that of the prepared pair by more than 4 %")                         \
    X(BRIDGE_OUTSIDE_PENDULAR, 16, "every law: bridges of three touching spheres would meet")
enum bridge_outside_flag {
#define BRIDGE__FLAG(name, value, text) name = value,
    BRIDGE_OUTSIDES(BRIDGE__FLAG)
#undef BRIDGE__FLAG
        BRIDGE_OUTSIDE_NOTHING = 0
};
/* Returns the flags for a bridge of `volume` [m3] between solids of these radii [m], which are the pair's i and j, and
   its contact angles. 0 for an unprepared pair. */
BRIDGE_API unsigned bridge_outside(const bridge_pair *pair, double radius_i, double radius_j, double volume);
BRIDGE_API const char *bridge_outside_text(unsigned flag); /* of one flag; never NULL; static storage */

/* >>step-list: what a time step calls ------------------------------------------------------------------------------ */

/* Returns the capillary attraction [N] at gap S [m] (any; S <= 0 is contact). Beyond the static rupture gap, on the way
   to dynamic rupture, X falls on. */
BRIDGE_INLINE double bridge_attraction(const bridge *b, double gap);
/* Computes the normal and tangential resistance (eq 16; Couette with its logarithm to 2e-5), of width and radius alone;
   width 0: none. */
BRIDGE_INLINE bridge_resistances bridge_resistance(const bridge *b, const bridge_liquid *liquid, double gap);
/* Computes everything at once: capillary attraction, normal and tangential viscous resistance (eq 16; Couette with its
   logarithm to 2e-5). */
BRIDGE_INLINE bridge_forces bridge_evaluate(const bridge *b, const bridge_liquid *liquid, double gap, double velocity);
/* Returns 1 if the gap is beyond the dynamic rupture distance (eq 20). */
BRIDGE_INLINE int bridge_is_ruptured(const bridge *b, const bridge_liquid *liquid, double gap, double velocity);
/* Evaluates eqs 12-18 as printed, with max(gap, 0) for the gap, because eq 14 is not real in contact. Slow: it
   computes sines. */
static inline bridge_forces bridge_evaluate_printed(const bridge_pair *pair, const bridge *b, double gap,
                                                    double velocity);

/* Returns the work [J] that the capillary force takes from the pair while the gap opens from `from` to `to` (either may
   be below 0 or beyond rupture). */
BRIDGE_API double bridge_work(const bridge *b, double from, double to);
/* The bridge's stiffness -dF/dS at contact [N/m] and its largest resistances [N s/m] (at S <= 0), for the choice of a
   time step: explicit steps need dt < m_eff/normal and dt < 0.4 m_eff/tangential (solid spheres), and |velocity| dt
   well below the bridge's width. */
typedef struct bridge_stiffness {
    double capillary, normal, tangential;
} bridge_stiffness;
BRIDGE_API bridge_stiffness bridge_contact_stiffness(const bridge *b, const bridge_liquid *liquid);

/* >>books-list: who has which liquid ------------------------------------------------------------------------------- */

/* Films. The caller owns every array. All volumes are kept as multiples of `quantum`, a power of two: sums and
   differences are then exact, in any order, and liquid is conserved to the last bit, not only to round-off. */
typedef struct bridge_films {
    double *particle; /* free film on each particle [m3], shape [n_particles], multiples of quantum */
    size_t n_particles;
    double *patch;            /* film on each wall patch [m3], shape [n_patches], multiples of quantum */
    const double *patch_area; /* [m2], > 0, shape [n_patches] */
    size_t n_patches;         /* 0: patch and patch_area may be NULL */
    double *scratch;          /* [n_particles + n_patches], used by bridge_allocate, content irrelevant */
    double quantum;           /* [m3], from bridge_quantum */
    double added;             /* liquid added by bridge_add [m3] */
    double evaporated;        /* liquid removed by bridge_evaporate [m3] */
} bridge_films;

typedef enum bridge_partner { BRIDGE_SPHERE, BRIDGE_WALL, BRIDGE_WIRE } bridge_partner;

/* A new contact that requests a bridge. */
typedef struct bridge_contact {
    size_t i;                      /* particle */
    size_t j;                      /* particle (BRIDGE_SPHERE) or patch (BRIDGE_WALL, BRIDGE_WIRE) */
    bridge_partner partner;        /* determines the shares: eq 7; 8 and 9; 10 and 11 */
    double radius_i, radius_j;     /* [m]; radius_j: the sphere's or the wire's, not read for a wall */
    double volume_min, volume_max; /* [m3], from bridge_volume_range: below it no bridge, above it the rest stays
                                      in the films */
    double given_i, given_j;       /* result [m3]: given by i and by j; both 0: no bridge */
} bridge_contact;

/* Returns a quantum for `total` [m3] > 0, all the liquid there will ever be: 2^-51 of it or less. */
BRIDGE_API double bridge_quantum(double total);
/* Returns `volume` rounded down to a multiple of the quantum. */
static inline double bridge_quantised(double volume, double quantum);
/* Distributes liquid to all new contacts of a step. Each requests its share by eqs 7-11 of the films at the call; where
   the requests exceed a film, each gets the same fraction of its request. Films are reduced. The result depends on the
   set of contacts, not on their order (but for the last quantum of an exhausted film). BRIDGE_INVALID, and nothing
   changed, for an index or a size out of range. Time: n. */
BRIDGE_API bridge_status bridge_allocate(bridge_films *films, bridge_contact *contacts, size_t n);
/* Returns the part of the bridge's liquid that i gets at rupture [m3], a multiple of quantum; j gets b->volume minus
   it, exactly. */
static inline double bridge_split_volume(const bridge *b, double quantum);
/* Ruptures a bridge: its liquid returns to the films of i and j, and b->volume becomes 0. BRIDGE_INVALID, and nothing
   changed, for a bad index, volume or split. */
BRIDGE_API bridge_status bridge_release(bridge_films *films, bridge *b, size_t i, size_t j, bridge_partner partner);
/* Adds `amount` >= 0 [m3] (rounded down to a quantum) to a film, which is &films->particle[i] or &films->patch[k].
   Returns the amount added; NaN for a bad amount, and nothing is added. */
BRIDGE_API double bridge_add(bridge_films *films, double *film, double amount);
/* Takes `amount` >= 0 [m3] (rounded down), at most all, from a film. Returns the amount taken. */
BRIDGE_API double bridge_evaporate(bridge_films *films, double *film, double amount);
/* Takes liquid from a bridge and computes its series again (its split stays). Returns 0 and takes nothing if too little
   for the table would remain. */
BRIDGE_API double bridge_evaporate_bridge(bridge_films *films, const bridge_pair *pair, bridge *b, double amount);
/* Returns the compensated sum of n doubles `stride` >= 1 doubles apart (Neumaier). NaN without values or
   with stride 0. */
BRIDGE_API double bridge_sum(const double *values, size_t n, size_t stride);
/* Returns the liquid in all films [m3]. */
BRIDGE_API double bridge_films_total(const bridge_films *films);

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
/* clang-format on */

/* >>laws ----------------------------------------------------------------------------------------------------------- */

static inline const char *bridge_status_text(bridge_status status) {
    switch (status) {
#define BRIDGE__CASE(name, text)                                                                                       \
    case name: return text;
        BRIDGE_STATUSES(BRIDGE__CASE)
#undef BRIDGE__CASE
    case BRIDGE_STATUS_COUNT: break;
    }
    return "unknown status";
}

static inline double bridge__nan(void) { return (double)NAN; }

static inline int bridge__is_finite(double x) { return fabs(x) <= 1.7976931348623157e308; }

static inline int bridge__is_angle(double angle) { return angle >= 0.0 && angle <= 0.5 * RIDDLE_PI; }

static inline double bridge_harmonic_radius(double ri, double rj) {
    if (!(ri > 0.0 && rj > 0.0)) return bridge__nan();
    return ri < rj ? 2.0 * ri / (1.0 + ri / rj) : 2.0 * rj / (1.0 + rj / ri);
}

static inline double bridge_reduced_radius(double ri, double rj) { return 0.5 * bridge_harmonic_radius(ri, rj); }

static inline double bridge_neck_area(double volume, double harmonic_radius) {
    if (!(volume >= 0.0 && harmonic_radius > 0.0)) return bridge__nan();
    return 2.0 / RIDDLE_PI * volume / harmonic_radius;
}

static inline double bridge_neck_factor(double gap, double neck_area) {
    if (!(gap >= 0.0 && neck_area >= 0.0)) return bridge__nan();
    if (neck_area == 0.0) return 0.0;
    double h = sqrt(gap * gap + neck_area);
    return neck_area / h / (h + gap);
}

static inline double bridge_arm(double ri, double rj, double gap) { return ri * (1.0 + gap / (ri + rj)); }

static inline double bridge_share_sphere(double film_i, double ri, double rj) {
    if (!(film_i >= 0.0 && ri > 0.0 && rj > 0.0 && bridge__is_finite(ri))) return bridge__nan();
    double p = rj / ri, q = ri / rj; /* the smaller of the two keeps its digits */
    double sine = p < 1.0 ? p / (1.0 + p) : 1.0 / (1.0 + q);
    double cosine = p < 1.0 ? sqrt(1.0 + 2.0 * p) / (1.0 + p) : sqrt(q * (q + 2.0)) / (1.0 + q);
    return film_i * sine * sine / (2.0 * (1.0 + cosine));
}

static inline double bridge_share_wall(double film_i) {
    return film_i >= 0.0 ? film_i * 0.066987298107780677 : bridge__nan();
}

static inline double bridge_share_wall_film(double thickness, double ri) {
    return thickness >= 0.0 && ri > 0.0 ? thickness * (0.25 * RIDDLE_PI) * ri * ri : bridge__nan();
}

static inline double bridge_share_wire(double film_i, double ri, double rw) {
    return film_i >= 0.0 && ri > 0.0 && rw > 0.0 && rw <= 6.0 * ri ? film_i * rw / (6.0 * ri) : bridge__nan();
}

static inline double bridge_share_wire_film(double thickness, double ri, double rw) {
    return thickness >= 0.0 && ri > 0.0 && rw > 0.0 ? 2.0 * thickness * ri * rw : bridge__nan();
}

static inline double bridge_filling_angle(double gap, double volume, double harmonic_radius) {
    double a = bridge_neck_area(volume, harmonic_radius);
    if (!(gap >= 0.0 && a >= 0.0)) return bridge__nan();
    return a == 0.0 ? 0.0 : sqrt(a / harmonic_radius / (gap + sqrt(gap * gap + a)));
}

static inline double bridge_filling_angle_plate(double gap, double volume, double radius) {
    return 2.0 * bridge_filling_angle(gap, volume, 2.0 * radius);
}

static inline double bridge_effective_angle(double angle_i, double angle_j) {
    if (!(bridge__is_angle(angle_i) && bridge__is_angle(angle_j))) return bridge__nan();
    /* 1 - cos in place of cos: no digits are lost near 0 */
    double si = riddle_sin(0.5 * angle_i), sj = riddle_sin(0.5 * angle_j);
    return 2.0 * riddle_asin(sqrt(0.5 * (si * si + sj * sj)));
}

/* Returns pi sigma R_h (cos i + cos j) [N]; NaN outside the domain that all the capillary laws share */
static inline double bridge__scale(double gap, double volume, double harmonic_radius, double angle_i, double angle_j,
                                   double surface_tension) {
    if (!(gap >= 0.0 && volume > 0.0 && harmonic_radius > 0.0 && surface_tension > 0.0)) return bridge__nan();
    if (!(bridge__is_angle(angle_i) && bridge__is_angle(angle_j))) return bridge__nan();
    return RIDDLE_PI * surface_tension * harmonic_radius * (riddle_cos(angle_i) + riddle_cos(angle_j));
}

static inline double bridge_force_energy(double gap, double volume, double harmonic_radius, double angle_i,
                                         double angle_j, double surface_tension) {
    return bridge__scale(gap, volume, harmonic_radius, angle_i, angle_j, surface_tension) *
           bridge_neck_factor(gap, bridge_neck_area(volume, harmonic_radius));
}

static inline double bridge_stiffness_energy(double gap, double volume, double harmonic_radius, double angle_i,
                                             double angle_j, double surface_tension) {
    double a = bridge_neck_area(volume, harmonic_radius), h = sqrt(gap * gap + a);
    return -bridge__scale(gap, volume, harmonic_radius, angle_i, angle_j, surface_tension) * (a / h / h / h);
}

static inline double bridge_work_energy(double gap, double volume, double harmonic_radius, double angle_i,
                                        double angle_j, double surface_tension) {
    double a = bridge_neck_area(volume, harmonic_radius), w = sqrt(a), h = sqrt(gap * gap + a);
    /* sqrt(a) + S - h as a product */
    return bridge__scale(gap, volume, harmonic_radius, angle_i, angle_j, surface_tension) *
           (gap * 2.0 * w / (w + gap + h));
}

static inline double bridge_force_tension(double gap, double volume, double harmonic_radius, double angle_i,
                                          double angle_j, double surface_tension) {
    double filling = bridge_filling_angle(gap, volume, harmonic_radius);
    return bridge_force_energy(gap, volume, harmonic_radius, angle_i, angle_j, surface_tension) +
           2.0 * RIDDLE_PI * surface_tension * harmonic_radius * riddle_sin(filling) *
               riddle_sin(0.5 * (angle_i + angle_j) + filling);
}

static inline double bridge_force_tension_plate(double gap, double volume, double radius, double angle_i,
                                                double angle_j, double surface_tension) {
    double filling = bridge_filling_angle_plate(gap, volume, radius);
    return bridge_force_energy(gap, volume, 2.0 * radius, angle_i, angle_j, surface_tension) +
           2.0 * RIDDLE_PI * surface_tension * radius * riddle_sin(filling) *
               riddle_sin(0.5 * (angle_i + angle_j) + filling);
}

static inline double bridge_force_willett(double gap, double volume, double harmonic_radius, double angle,
                                          double surface_tension) {
    double v = volume / (harmonic_radius * harmonic_radius * harmonic_radius), t = angle, u = t * t;
    if (!(gap >= 0.0 && harmonic_radius > 0.0 && surface_tension > 0.0 && v >= 5e-5 && v <= 0.2 && t >= 0.0 &&
          t <= 0.8727))
        return bridge__nan();
    double L = riddle_log(v), p = 0.5 * gap * sqrt(harmonic_radius / volume);
    double f1 = (-0.44507 + 0.050832 * t - 1.1466 * u) + (-0.1119 - 0.000411 * t - 0.1490 * u) * L +
                (-0.012101 - 0.0036456 * t - 0.01255 * u) * L * L +
                (-0.0005 - 0.0003505 * t - 0.00029076 * u) * L * L * L;
    double f2 = (1.9222 - 0.57473 * t - 1.2918 * u) + (-0.0668 - 0.1201 * t - 0.22574 * u) * L +
                (-0.0013375 - 0.0068988 * t - 0.01137 * u) * L * L;
    double f3 = (1.268 - 0.01396 * t - 0.23566 * u) + (0.198 + 0.092 * t - 0.06418 * u) * L +
                (0.02232 + 0.02238 * t - 0.009853 * u) * L * L + (0.0008585 + 0.001318 * t - 0.00053 * u) * L * L * L;
    double f4 = (-0.010703 + 0.073776 * t - 0.34742 * u) + (0.03345 + 0.04543 * t - 0.09056 * u) * L +
                (0.0018574 + 0.004456 * t - 0.006257 * u) * L * L;
    /* exp(f3 l + f4 l^2) -> 0 as p -> 0 where f4 < 0; below p = 1e-6 it is left at that limit */
    double l = p > 1e-6 ? riddle_log(p) : 0.0, decay = p > 1e-6 ? riddle_exp(f3 * l + f4 * l * l) : 0.0;
    return 2.0 * RIDDLE_PI * surface_tension * harmonic_radius * riddle_exp(f1 - f2 * decay);
}

static inline double bridge_force_willett_simple(double gap, double volume, double harmonic_radius, double angle_i,
                                                 double angle_j, double surface_tension) {
    double s = gap * sqrt(harmonic_radius / volume);
    return bridge__scale(gap, volume, harmonic_radius, angle_i, angle_j, surface_tension) /
           (1.0 + (1.05 + 2.5 * s) * s);
}

BRIDGE_INLINE double bridge_viscous_gap(double gap, double reduced_radius, double roughness) {
    return (gap > 0.0 ? gap : 0.0) + roughness * reduced_radius + 0.0 * gap; /* 0 * gap: NaN stays NaN */
}

static inline double bridge_drag_normal(double viscous_gap, double volume, double reduced_radius, double viscosity) {
    if (!(viscous_gap > 0.0 && viscosity >= 0.0)) return bridge__nan();
    double x = bridge_neck_factor(viscous_gap, bridge_neck_area(volume, 2.0 * reduced_radius));
    return 6.0 * RIDDLE_PI * viscosity * reduced_radius * (reduced_radius / viscous_gap) * x * x;
}

static inline double bridge_drag_tangential(double viscous_gap, double volume, double reduced_radius,
                                            double viscosity) {
    if (!(viscous_gap > 0.0 && viscosity >= 0.0)) return bridge__nan();
    double a = bridge_neck_area(volume, 2.0 * reduced_radius);
    return RIDDLE_PI * viscosity * reduced_radius * riddle_log1p(a / viscous_gap / viscous_gap);
}

static inline double bridge_goldman_translation_near(double x) {
    return x > 0.0 ? 0.9588 - 8.0 / 15.0 * riddle_log(x) : bridge__nan();
}

static inline double bridge_goldman_translation_far(double x) {
    if (!(x > 0.0)) return bridge__nan();
    double q = 1.0 / (1.0 + x), q3 = q * q * q;
    return 1.0 / (1.0 - 9.0 / 16.0 * q + q3 * (1.0 / 8.0 - q * (45.0 / 256.0 + q / 16.0)));
}

static inline double bridge_goldman_coupling_near(double x) {
    return x > 0.0 ? -0.2526 - 2.0 / 15.0 * riddle_log(x) : bridge__nan();
}

static inline double bridge_goldman_coupling_far(double x) {
    if (!(x > 0.0)) return bridge__nan();
    double q = 1.0 / (1.0 + x);
    return 0.125 * q * q * q * q * (1.0 - 0.375 * q);
}

static inline double bridge_goldman_rotation(double x) {
    if (!(x > 0.0)) return bridge__nan();
    double q = 1.0 / (1.0 + x);
    return x < 0.1 ? 0.50893 - 8.0 / 15.0 * riddle_log(x) : 4.0 / 3.0 * (1.0 + 5.0 / 16.0 * q * q * q);
}

static inline double bridge_rupture_gap(double volume, double harmonic_radius, double radius_ratio, double angle_i,
                                        double angle_j) {
    if (!(volume >= 0.0 && harmonic_radius > 0.0 && radius_ratio >= 0.0 && radius_ratio <= 1.0)) return bridge__nan();
    if (!(bridge__is_angle(angle_i) && bridge__is_angle(angle_j))) return bridge__nan();
    double v = riddle_cbrt(volume) / harmonic_radius;
    if (!(v * v * v <= 15.0)) return bridge__nan();
    return harmonic_radius * (1.0 + 0.125 * (angle_i + angle_j) * (1.0 + radius_ratio)) *
           (v + (0.5 * radius_ratio - 0.4) * v * v);
}

static inline double bridge_rupture_gap_unequal(double volume, double harmonic_radius, double radius_ratio,
                                                double angle_small, double angle_large) {
    /* of products k^a v^b s^e l^f up to the third order, f running fastest: fitted by tests/fit_rupture_gap.c */
    const double c[2][35] = {{0.01279, 0.06450,  0.41142,  -0.05031, -0.04597, 0.03398, -0.10195, -0.26701, -0.04387,
                              0.06815, -0.08857, -0.03500, -0.14621, -0.12485, 0.09334, 0.10749,  0.08286,  0.05694,
                              0.03675, -0.02093, 0.00340,  -0.10857, 0.14826,  0.01613, -0.07979, -0.08237, 0.25841,
                              0.07467, -0.13002, -0.11920, -0.07284, -0.00477, 0.02248, -0.04549, 0.02796},
                             {-0.03509, 0.17526,  -0.58305, 0.21212,  -0.10518, 0.27457,  -0.18725, 0.66074,  -0.32321,
                              0.03400,  0.79309,  -0.32274, -0.00582, 0.47877,  -0.16374, 0.10771,  0.20136,  0.06504,
                              -0.09491, -0.02925, 0.04177,  -0.13727, 0.03630,  -0.22106, 0.14185,  -0.07989, -1.37773,
                              0.29486,  -0.33841, -0.13795, 0.03010,  -0.02510, 0.09686,  0.54305,  -0.03915}};
    const double gap = bridge_rupture_gap(volume, harmonic_radius, radius_ratio, angle_small, angle_large),
                 k = radius_ratio;
    double v = 2.0 * riddle_cbrt(volume) / harmonic_radius, s = 1.25 * angle_small, l = 1.25 * angle_large,
           branch[2] = {0.0, 0.0};
    const double v_most = 0.92831776672255573, most = 1.0908307824964559; /* 2 cbrt(0.1), 50 degrees */
    int n = 0;
    if (k == 1.0 && s > l) { /* equal spheres have no smaller one */
        const double swapped = s;
        s = l, l = swapped;
    }
    if (v > v_most) v = v_most;
    if (s > most) s = most;
    if (l > most) l = most;
    double ka = 1.0;
    for (int a = 0; a <= 3; a++, ka *= k) {
        double vb = ka;
        for (int b = 0; a + b <= 3; b++, vb *= v) {
            double se = vb;
            for (int e = 0; a + b + e <= 3; e++, se *= s) {
                double lf = se;
                for (int f = 0; a + b + e + f <= 3; f++, lf *= l, n++)
                    branch[0] += c[0][n] * lf, branch[1] += c[1][n] * lf;
            }
        }
    }
    return gap * riddle_exp(branch[0] < branch[1] ? branch[0] : branch[1]);
}

static inline double bridge_rupture_gap_dynamic(double rupture_gap, double velocity, double surface_tension,
                                                double viscosity) {
    if (!(rupture_gap >= 0.0 && surface_tension > 0.0 && viscosity >= 0.0 && velocity == velocity))
        return bridge__nan();
    return rupture_gap * (1.0 + sqrt(viscosity * (velocity > 0.0 ? velocity : 0.0) / surface_tension));
}

static inline double bridge_sticking_velocity(double work, double reduced_mass, double restitution) {
    if (!(work >= 0.0 && reduced_mass > 0.0 && restitution > 0.0 && restitution <= 1.0)) return bridge__nan();
    return sqrt(2.0 * work / reduced_mass) / restitution;
}

static inline double bridge_wet_restitution(double work, double reduced_mass, double restitution, double velocity) {
    if (!(work >= 0.0 && reduced_mass > 0.0 && restitution >= 0.0 && restitution <= 1.0 && velocity > 0.0))
        return bridge__nan();
    double left = restitution * restitution - 2.0 * work / reduced_mass / velocity / velocity;
    return left > 0.0 ? sqrt(left) : 0.0;
}

/* >>printed -------------------------------------------------------------------------------------------------------- */

static inline double bridge_printed_force(double gap, double volume, double harmonic_radius, double angle_i,
                                          double angle_j, double surface_tension) {
    double mean = 0.5 * (angle_i + angle_j);
    return bridge_force_energy(gap, volume, harmonic_radius, angle_i, angle_j, surface_tension) +
           2.0 * RIDDLE_PI * surface_tension * harmonic_radius * riddle_sin(mean) *
               riddle_sin(mean + bridge_filling_angle(gap, volume, harmonic_radius));
}

static inline double bridge_printed_force_wall(double gap, double volume, double radius, double angle_i, double angle_w,
                                               double surface_tension) {
    double mean = 0.5 * (angle_i + angle_w);
    return bridge__scale(gap, volume, 2.0 * radius, angle_i, angle_w, surface_tension) /
               (1.0 + gap * sqrt(RIDDLE_PI * radius / volume)) +
           2.0 * RIDDLE_PI * surface_tension * radius * riddle_sin(mean) *
               riddle_sin(mean + bridge_printed_filling_angle_wall(gap, volume, radius));
}

static inline double bridge_printed_filling_angle_wall(double gap, double volume, double radius) {
    if (!(gap >= 0.0 && volume >= 0.0 && radius > 0.0)) return bridge__nan();
    return sqrt(2.0 / radius * sqrt(gap * gap + volume / (RIDDLE_PI * radius)));
}

static inline double bridge_printed_drag_translation(double viscous_gap, double reduced_radius, double viscosity) {
    return 6.0 * RIDDLE_PI * viscosity * reduced_radius * bridge_goldman_translation_near(viscous_gap / reduced_radius);
}

static inline double bridge_printed_drag_spin(double viscous_gap, double reduced_radius, double viscosity) {
    double x = viscous_gap / reduced_radius;
    return -6.0 * RIDDLE_PI * viscosity * reduced_radius *
           (x < 0.1 ? bridge_goldman_coupling_near(x) : bridge_goldman_coupling_far(x));
}

/* >>step ----------------------------------------------------------------------------------------------------------- */

BRIDGE_INLINE double bridge_attraction(const bridge *b, double gap) {
    if (!(b->volume > 0.0)) return 0.0;
    double s = gap > 0.0 ? gap : 0.0, left = b->rupture_gap - s, a = b->width * b->width;
    double h = sqrt(s * s + a), tau = sqrt(left > 0.0 ? left : 0.0);
    const double *c = b->series;
    double sum = c[0] + tau * (c[1] + tau * (c[2] + tau * (c[3] + tau * (c[4] + tau * (c[5] + tau * c[6])))));
    return sum * a / (h * (h + s));
}

BRIDGE_INLINE bridge_resistances bridge_resistance(const bridge *b, const bridge_liquid *liquid, double gap) {
    double s = (gap > 0.0 ? gap : 0.0) + liquid->roughness * 0.5 * b->radius, a = b->width * b->width;
    double h = sqrt(s * s + a), d = h * (h + s), inverse = 1.0 / (d * s), x = a * s * inverse,
           scale = RIDDLE_PI * liquid->viscosity * b->radius;
    /* ln(h/s) = 2 (1 - p) n(p)/d(p) without a logarithm, p = sqrt(s/h): to 2e-5 for p from 0.02 (roughness 2e-4,
       V/R_h^3 = 0.1) to 1 */
    double p = sqrt(s * s * (h + s) * inverse);
    double numerator =
        6.3827022621613418 + p * (477.44372830592164 + p * (3601.5670170765813 + p * 2818.6395609047166));
    double denominator =
        1.0 + p * (129.69017714253422 + p * (1829.7796093208002 + p * (3971.2137371759904 + p * 972.48453376442603)));
    bridge_resistances r = {1.5 * scale * b->radius * x * x * d * inverse,
                            2.0 * scale * (1.0 - p) * numerator / denominator};
    return r;
}

BRIDGE_INLINE bridge_forces bridge_evaluate(const bridge *b, const bridge_liquid *liquid, double gap, double velocity) {
    bridge_forces f = {bridge_attraction(b, gap), 0.0, 0.0};
    if (!(b->volume > 0.0 && liquid->viscosity > 0.0)) return f;
    bridge_resistances r = bridge_resistance(b, liquid, gap);
    f.normal += r.normal * velocity;
    f.tangential = f.spin = r.tangential;
    return f;
}

BRIDGE_INLINE int bridge_is_ruptured(const bridge *b, const bridge_liquid *liquid, double gap, double velocity) {
    double beyond = gap - b->rupture_gap; /* S > S_rup (1 + sqrt(Ca)) without the root */
    return beyond > 0.0 && beyond * beyond * liquid->surface_tension >
                               b->rupture_gap * b->rupture_gap * liquid->viscosity * (velocity > 0.0 ? velocity : 0.0);
}

static inline bridge_forces bridge_evaluate_printed(const bridge_pair *pair, const bridge *b, double gap,
                                                    double velocity) {
    bridge_forces f = {0.0, 0.0, 0.0};
    if (!(b->volume > 0.0)) return f;
    const bridge_liquid *liquid = &pair->def.liquid;
    double s = gap > 0.0 ? gap : 0.0, rs = 0.5 * b->radius, sv = bridge_viscous_gap(gap, rs, liquid->roughness);
    f.normal = bridge__is_finite(pair->def.radius_j)
                   ? bridge_printed_force(s, b->volume, b->radius, pair->def.angle_i, pair->def.angle_j,
                                          liquid->surface_tension)
                   : bridge_printed_force_wall(s, b->volume, rs, pair->def.angle_i, pair->def.angle_j,
                                               liquid->surface_tension);
    f.normal += bridge_drag_normal(sv, b->volume, rs, liquid->viscosity) * velocity;
    f.tangential = bridge_printed_drag_translation(sv, rs, liquid->viscosity);
    f.spin = bridge_printed_drag_spin(sv, rs, liquid->viscosity);
    return f;
}

static inline double bridge_quantised(double volume, double quantum) { return floor(volume / quantum) * quantum; }

static inline double bridge_split_volume(const bridge *b, double quantum) {
    return bridge_quantised(b->split * b->volume, quantum);
}

#ifdef BRIDGE__BODIES

/* >>solver: Young-Laplace without gravity, lengths in R_h ---------------------------------------------------------- */

/* The meridian of the liquid is a Delaunay curve. With neck radius y0, K = pressure/sigma and u = (2/K) tan(K s/2), s
   the arc from the neck, it is algebraic: y^2 = y0^2 + (1 - K y0) u^2 e, ds = e du, e = 1/(1 + K^2 u^2/4), and n = y
   cos(psi) = C + K y^2/2 with C = y0 - K y0^2/2 the force over 2 pi sigma. It meets a sphere of curvature rho at
   contact angle theta where
       g = w (rho w - K cos(theta)/2) u^2 + sin(theta) (1 - K y0) u - y0 (cos(theta) - rho y0) = 0,   w = 1 - K y0/2.
   Nothing is singular for K of either sign, at K = 0, for a plate (rho = 0), or where the neck lies inside a
   solid (u < 0). */

typedef struct bridge__solid {
    double curvature, cosine, sine;
} bridge__solid;

/* One side of the neck; [0] value, [1..3] derivatives by y0, K, u. */
typedef struct bridge__half {
    double x[4], v[4], g[4]; /* height of the solid's apex over the neck, volume between, contact condition */
    double ring2, area;      /* squared radius of the wetted circle, area of the meniscus */
} bridge__half;

typedef struct bridge__problem {
    bridge__solid solid[2];
    int symmetric; /* solved with both halves equal */
    int close;     /* nearly equal spheres, poorly wetted: the branch bends near the instability of equal ones */
    double step;   /* in ln y0 while the family is followed */
    int work;      /* iterations of Newton's method so far */
    double volume;
} bridge__problem;

/* z = ln(u_i + u_j), ln y0, ln(1 - K y0), u_i/(u_i + u_j) - 1/2. Along a bridge that opens, ln y0 falls all the way,
   through the fold. */
typedef struct bridge__meniscus {
    double z[4], neck, pressure, force, gap;
    double slope; /* d gap/d ln y0 at constant volume: 0 at the fold, < 0 before it */
    double drift; /* d z[3]/d ln y0 likewise */
    bridge__half half[2];
} bridge__meniscus;

static const double bridge__gauss[16][2] =
    {/* Gauss-Legendre, 32 points on 0 .. 1: abscissa (and its mirror), weight */
     {0.0013680690752592182, 0.0035093050047350483}, {0.0071942442273658323, 0.0081371973654528353},
     {0.017618872206246785, 0.01269603265463103},    {0.032546962031130155, 0.017136931456510717},
     {0.051839422116973938, 0.02141794901111334},    {0.075316193133715015, 0.025499029631188088},
     {0.1027581020160288, 0.029342046739267774},     {0.13390894062985516, 0.032911111388180923},
     {0.1684778665348924, 0.036172897054424253},     {0.20614212137961884, 0.039096947893535153},
     {0.2465500455338853, 0.041655962113473378},     {0.28932436193468233, 0.043826046502201906},
     {0.33406569885893618, 0.045586939347881942},    {0.38035631887393146, 0.046922199540402283},
     {0.42776401920860175, 0.04781936003963743},     {0.47584616715613084, 0.0482700442573639}};

static inline int bridge__half_solve(const bridge__solid *solid, double y0, double K, double u, bridge__half *half) {
    double kappa = 1.0 - K * y0, C = y0 * (1.0 - 0.5 * K * y0);
    double x = 0.0, xy = 0.0, xk = 0.0, v = 0.0, vy = 0.0, vk = 0.0, area = 0.0, Y = 0.0, Yy = 0.0, Yk = 0.0, e = 0.0,
           y = 0.0, n = 0.0;
    for (int i = 0; i <= 32; i++) { /* the 33rd point is the end itself */
        const double *node = bridge__gauss[(i < 16 ? i : 31 - i) & 15];
        double t = i == 32 ? u : u * (i < 16 ? node[0] : 1.0 - node[0]), weight = i == 32 ? 0.0 : u * node[1];
        e = 1.0 / (1.0 + 0.25 * K * K * t * t);
        double z = t * t * e, ek = -0.5 * e * z * K;
        Y = y0 * y0 + kappa * z;
        if (!(Y > 0.0)) return 0;
        Yy = 2.0 * y0 - K * z;
        Yk = -y0 * z + kappa * t * t * ek;
        y = sqrt(Y);
        n = C + 0.5 * K * Y;
        double ny = kappa + 0.5 * K * Yy, nk = 0.5 * (Y - y0 * y0 + K * Yk), inverse = 1.0 / y, f = n * inverse,
               p = n * y;
        double r = 0.5 * inverse * inverse;
        x += weight * e * f;
        xy += weight * e * (ny * inverse - f * Yy * r);
        xk += weight * (e * (nk * inverse - f * Yk * r) + f * ek);
        v += weight * e * p;
        vy += weight * e * (ny * y + p * Yy * r);
        vk += weight * (e * (nk * y + p * Yk * r) + p * ek);
        area += weight * e * y;
    }
    double rho = solid->curvature, cosine2 = 1.0 - rho * rho * Y;
    if (!(cosine2 > 0.0)) return 0;
    double Yu = 2.0 * kappa * u * e * e, cosine = sqrt(cosine2), cap = rho * Y / (1.0 + cosine),
           capY = 0.5 * rho / cosine;
    double lens = cap * (3.0 * Y + cap * cap) / 6.0, lensY = 0.5 * (capY * (Y + cap * cap) + cap);
    double w = 1.0 - 0.5 * K * y0, c = solid->cosine, s = solid->sine, m = rho * w - 0.5 * K * c;
    half->x[0] = x - cap;
    half->x[1] = xy - capY * Yy;
    half->x[2] = xk - capY * Yk;
    half->x[3] = e * n / y - capY * Yu;
    half->v[0] = RIDDLE_PI * (v - lens);
    half->v[1] = RIDDLE_PI * (vy - lensY * Yy);
    half->v[2] = RIDDLE_PI * (vk - lensY * Yk);
    half->v[3] = RIDDLE_PI * (e * n * y - lensY * Yu);
    half->g[0] = w * m * u * u + s * kappa * u - y0 * (c - rho * y0);
    half->g[1] = -0.5 * K * (m + w * rho) * u * u - s * K * u - c + 2.0 * rho * y0;
    half->g[2] = -0.5 * (y0 * m + w * (rho * y0 + c)) * u * u - s * y0 * u;
    half->g[3] = 2.0 * w * m * u + s * kappa;
    half->ring2 = Y;
    half->area = 2.0 * RIDDLE_PI * area;
    return 1;
}

/* Solves n equations a[n][columns] by Gauss-Jordan elimination with partial pivoting; the columns - n right-hand sides
   become the solutions. Returns 0 if the matrix is singular. */
static inline int bridge__solve(double *a, int n, int columns) {
    for (int c = 0; c < n; c++) {
        int pivot = c;
        for (int i = c + 1; i < n; i++)
            if (fabs(a[i * columns + c]) > fabs(a[pivot * columns + c])) pivot = i;
        if (!(fabs(a[pivot * columns + c]) > 0.0)) return 0;
        for (int j = 0; j < columns; j++) {
            double swap = a[c * columns + j];
            a[c * columns + j] = a[pivot * columns + j];
            a[pivot * columns + j] = swap;
        }
        for (int i = 0; i < n; i++) {
            double factor = i == c ? 0.0 : a[i * columns + c] / a[c * columns + c];
            for (int j = c; j < columns && factor != 0.0; j++) a[i * columns + j] -= factor * a[c * columns + j];
        }
    }
    for (int i = 0; i < n; i++)
        for (int j = n; j < columns; j++) a[i * columns + j] /= a[i * columns + i];
    return 1;
}

static inline int bridge__meniscus_update(const bridge__problem *problem, bridge__meniscus *m) {
    double length = riddle_exp(m->z[0]), neck = riddle_exp(m->z[1]), K = (1.0 - riddle_exp(m->z[2])) / neck;
    m->neck = neck;
    m->pressure = K;
    m->force = neck * (1.0 - 0.5 * K * neck);
    double ui = length * (problem->symmetric ? 0.5 : 0.5 + m->z[3]);
    if (!bridge__half_solve(&problem->solid[0], neck, K, ui, &m->half[0])) return 0;
    if (problem->symmetric) m->half[1] = m->half[0];
    else if (!bridge__half_solve(&problem->solid[1], neck, K, length - ui, &m->half[1])) return 0;
    m->gap = m->half[0].x[0] + m->half[1].x[0];
    return 1;
}

/* Derivatives by z of p + q, p a quantity of half 0 and q of half 1 (NULL: none). */
static inline void bridge__row(const bridge__meniscus *m, const double *p, const double *q, double *row) {
    double length = riddle_exp(m->z[0]), kappa = 1.0 - m->pressure * m->neck;
    double dy = (p ? p[1] : 0.0) + (q ? q[1] : 0.0), dk = (p ? p[2] : 0.0) + (q ? q[2] : 0.0), pu = p ? p[3] : 0.0,
           qu = q ? q[3] : 0.0;
    row[0] = length * ((0.5 + m->z[3]) * pu + (0.5 - m->z[3]) * qu);
    row[1] = m->neck * dy - m->pressure * dk;
    row[2] = -kappa / m->neck * dk;
    row[3] = length * (pu - qu);
}

/* Iterations of Newton's method after which a bridge counts as unsolved. In 12 000 bridges the most were 2300; equal
   spheres take 300. */
#define BRIDGE__WORK 30000

/* AT_NECK and AT_SKEW: the index of z. */
typedef enum bridge__aim { BRIDGE__AT_GAP = 0, BRIDGE__AT_NECK = 1, BRIDGE__AT_SKEW = 3 } bridge__aim;

/* Finds by Newton's method the bridge of the problem's volume that has a given gap, ln y0 or z[3] (aim), from m as a
   first guess. Returns whether it converged. */
static inline int bridge__newton(bridge__problem *problem, bridge__meniscus *m, bridge__aim aim, double target) {
    int n = problem->symmetric ? 3 : 4, columns = n + 2;
    double last = HUGE_VAL;
    for (int iteration = 0; iteration < 60; iteration++) {
        if (++problem->work > BRIDGE__WORK || !bridge__meniscus_update(problem, m)) return 0;
        const bridge__half *i = &m->half[0], *j = &m->half[1];
        double row[4][4], gap[4], a[4 * 6];
        double residual[4] = {aim == BRIDGE__AT_GAP ? target - m->gap : target - m->z[aim],
                              problem->volume - i->v[0] - j->v[0], -i->g[0], -j->g[0]};
        bridge__row(m, i->x, j->x, gap);
        bridge__row(m, i->v, j->v, row[1]);
        bridge__row(m, i->g, NULL, row[2]);
        bridge__row(m, NULL, j->g, row[3]);
        for (int k = 0; k < 4; k++) row[0][k] = aim == BRIDGE__AT_GAP ? gap[k] : (k == (int)aim ? 1.0 : 0.0);
        for (int r = 0; r < n; r++) {
            for (int k = 0; k < n; k++) a[r * columns + k] = row[r][k];
            a[r * columns + n] = residual[r];
            a[r * columns + n + 1] = r == 0 ? 1.0 : 0.0; /* second right-hand side: the direction of the family */
        }
        if (!bridge__solve(a, n, columns)) return 0;
        double largest = 0.0;
        m->slope = 0.0;
        for (int k = 0; k < n; k++) {
            double step = fabs(a[k * columns + n]) / (k == 3 ? 0.2 : 0.5);
            if (!(step < 1e6)) return 0;
            if (step > largest) largest = step;
            m->slope += gap[k] * a[k * columns + n + 1] / a[columns + n + 1];
        }
        m->drift = n > 3 ? a[3 * columns + n + 1] / a[columns + n + 1] : 0.0;
        for (int k = 0; k < n; k++) m->z[k] += a[k * columns + n] / (largest > 1.0 ? largest : 1.0);
        if (largest < 1e-13 || (largest < 1e-9 && largest >= 0.5 * last)) return bridge__meniscus_update(problem, m);
        last = largest;
    }
    return 0;
}

/* Finds the bridge of spheres in contact. Small volumes start from the parabolic gap; large ones are grown from
   a small one. */
static inline int bridge__in_contact(bridge__problem *problem, bridge__meniscus *m) {
    double wanted = problem->volume;
    int ok = 0;
    for (double volume = wanted < 1e-3 ? wanted : 1e-3;; volume = volume * 2.0 < wanted ? volume * 2.0 : wanted) {
        problem->volume = volume;
        if (!ok) {
            double h = sqrt(2.0 / RIDDLE_PI * volume), ring = sqrt(h), psi[2], K = 0.0, sag = 0.0;
            for (int k = 0; k < 2; k++) {
                double sine = ring * problem->solid[k].curvature;
                psi[k] = 0.5 * RIDDLE_PI - riddle_atan2(problem->solid[k].sine, problem->solid[k].cosine) -
                         riddle_asin(sine < 0.9 ? sine : 0.9);
                K += riddle_sin(psi[k]) / h;
            }
            double u[2], length;
            for (int k = 0; k < 2; k++) {
                u[k] = 2.0 * riddle_sin(0.5 * psi[k]) / riddle_cos(0.5 * psi[k]) / K;
                sag += 0.5 * (1.0 - riddle_cos(psi[k])) / K;
            }
            double neck = ring - sag > 0.3 * ring ? ring - sag : 0.3 * ring;
            length = u[0] + u[1];
            if (!(length > 0.0 && K > 0.0)) break;
            m->z[0] = riddle_log(length);
            m->z[1] = riddle_log(neck);
            m->z[2] = riddle_log(1.0 + K * neck);
            m->z[3] = problem->symmetric ? 0.0 : u[0] / length - 0.5;
        }
        ok = bridge__newton(problem, m, BRIDGE__AT_GAP, 0.0);
        if (!ok || !(volume < wanted)) break;
    }
    problem->volume = wanted;
    return ok && m->slope < 0.0 && m->force > 0.0;
}

/* Moves m along its family to another ln y0 or z[3] (aim) by Newton's method, if that stays on the branch. Near the
   instability of equal spheres the neck of unequal ones wanders off to one side, and a long leap lands on another
   solution: with g'(u) < 0 at both solids, or to the other side, where z[3] is not what its derivative leads to. */
static inline int bridge__leap(bridge__problem *problem, bridge__meniscus *m, bridge__aim aim, double target) {
    bridge__meniscus trial = *m;
    if (!bridge__newton(problem, &trial, aim, target)) return 0;
    double moved = trial.z[3] - m->z[3], opened = trial.z[1] - m->z[1];
    if (!(fabs(moved) < 0.06)) return 0;
    if (!(problem->symmetric || trial.half[0].g[3] > 0.0 || trial.half[1].g[3] > 0.0)) return 0;
    if (problem->close && aim == BRIDGE__AT_NECK) {
        double expected = 0.5 * (m->drift + trial.drift) * opened;
        if (!(fabs(moved - expected) <= 0.25 * (fabs(m->drift) + fabs(trial.drift)) * fabs(opened) + 1e-6)) return 0;
    }
    trial.z[aim] = target;
    *m = trial;
    return 1;
}

/* Moves m to another ln y0 or z[3] in as many leaps as are needed. */
static inline int bridge__advance(bridge__problem *problem, bridge__meniscus *m, bridge__aim aim, double target) {
    double part = 1.0;
    while (m->z[aim] != target) {
        if (bridge__leap(problem, m, aim, part < 1.0 ? m->z[aim] + part * (target - m->z[aim]) : target)) {
            part = 2.0 * part < 1.0 ? 2.0 * part : 1.0;
        } else {
            part *= 0.5;
            if (part < 1e-3) return 0;
        }
    }
    return 1;
}

/* Opens the bridge a little and tells by what (*aim). In general ln y0 falls by *step, or by half of it and so on if
   the branch is lost; *step may then grow again. Where the neck runs off to one side, |z[3]| grows by a half: ln y0
   hardly changes there, and turns back soon after the fold. (From a z[3] of 0 nothing can grow by a half.) */
static inline int bridge__open_a_little(bridge__problem *problem, bridge__meniscus *m, double *step, bridge__aim *aim) {
    *aim = BRIDGE__AT_NECK;
    if (!problem->close) return bridge__advance(problem, m, *aim, m->z[1] - problem->step);
    for (; *step > 1e-3 * problem->step; *step *= 0.5) {
        double skew = m->z[3], more = 0.5 * fabs(skew) < 0.02 ? 0.5 * skew : (skew < 0.0 ? -0.02 : 0.02);
        if (fabs(skew) > 1e-13 && -m->drift * *step / skew > 0.5) {
            *aim = BRIDGE__AT_SKEW;
            return bridge__advance(problem, m, *aim, skew + more);
        }
        if (bridge__leap(problem, m, *aim, m->z[1] - *step)) {
            *step = 2.0 * *step < problem->step ? 2.0 * *step : problem->step;
            return 1;
        }
    }
    return 0;
}

/* Returns the function whose zero ends a stable family, < 0 before it. It is the derivative of the contact condition at
   the first instability of a symmetric bridge (aim: the gap), else the slope along the way that is gone at the fold. */
static inline double bridge__event(const bridge__meniscus *m, bridge__aim aim) {
    if (aim == BRIDGE__AT_GAP) return -m->half[0].g[3];
    return aim == BRIDGE__AT_NECK ? m->slope : m->slope / m->drift * (m->z[3] < 0.0 ? 1.0 : -1.0);
}

/* Finds the meniscus between a (event < 0) and b (event > 0) at which the event is 0, by regula falsi
   with bisection. */
static inline int bridge__locate(bridge__problem *problem, const bridge__meniscus *a, const bridge__meniscus *b,
                                 bridge__aim event, bridge__meniscus *m) {
    bridge__aim aim = event == BRIDGE__AT_SKEW ? event : BRIDGE__AT_NECK;
    double za = a->z[aim], zb = b->z[aim], ea = bridge__event(a, event), eb = bridge__event(b, event);
    *m = *a;
    for (int i = 0; i < 80 && fabs(za - zb) > 1e-14; i++) {
        double z = i % 3 == 2 ? 0.5 * (za + zb) : (za * eb - zb * ea) / (eb - ea);
        if (!bridge__advance(problem, m, aim, z)) return 0;
        double e = bridge__event(m, event);
        if (e < 0.0) {
            za = z;
            ea = e;
        } else {
            zb = z;
            eb = e;
        }
        if (fabs(e) < 1e-15) break;
    }
    return 1;
}

static inline int bridge__follow_by_steps(bridge__problem *problem, const bridge__meniscus *contact,
                                          bridge__meniscus *rupture, bridge__meniscus *fold) {
    bridge__meniscus m = *contact;
    bridge__aim aim;
    double step = problem->step;
    int unstable = 0;
    while (m.z[1] > contact->z[1] - 12.0) { /* a neck is never that thin */
        bridge__meniscus before = m;
        if (!bridge__open_a_little(problem, &m, &step, &aim)) return 0;
        if (problem->symmetric && !unstable && m.half[0].g[3] < 0.0) {
            bridge__meniscus first;
            if (!bridge__locate(problem, &before, &m, BRIDGE__AT_GAP, &first)) return 0;
            unstable = first.slope < 0.0;
            if (unstable && rupture) *rupture = first;
            if (unstable && !fold) return 1;
        }
        if (bridge__event(&m, aim) >= 0.0) {
            bridge__meniscus last;
            if (!bridge__locate(problem, &before, &m, aim, &last)) return 0;
            if (fold) *fold = last;
            if (rupture && !unstable) *rupture = last;
            return 1;
        }
    }
    return 0;
}

/* Follows the family from contact: *rupture, its last stable member, and *fold. Either may be NULL. A branch that gets
   lost is tried again in smaller steps, which stay in *problem. */
static inline int bridge__follow(bridge__problem *problem, const bridge__meniscus *contact, bridge__meniscus *rupture,
                                 bridge__meniscus *fold) {
    for (int attempt = 0; attempt < 5; attempt++, problem->step *= 0.2)
        if (bridge__follow_by_steps(problem, contact, rupture, fold)) return 1;
    return 0;
}

static inline bridge__problem bridge__problem_of(const bridge_pair_def *def, double reduced_volume) {
    bridge__problem problem;
    /* Of spheres that differ by x the rupture gap is shorter by up to 0.64 x^(2/3) of itself, and up to 0.8 x^(1/3) of
       the liquid more stays on one: 1.4e-7 and 4e-4 at this x. Much below it the branch bends within rounding. */
    const double negligible = 1e-10;
    double radius = bridge_harmonic_radius(def->radius_i, def->radius_j), mean = 0.5 * (def->angle_i + def->angle_j);
    problem.symmetric =
        fabs(def->radius_i - def->radius_j) <= negligible * radius && fabs(def->angle_i - def->angle_j) <= negligible;
    for (int k = 0; k < 2; k++) {
        double angle = problem.symmetric ? mean : (k == 0 ? def->angle_i : def->angle_j);
        problem.solid[k].curvature = problem.symmetric ? 1.0 : radius / (k == 0 ? def->radius_i : def->radius_j);
        problem.solid[k].cosine = riddle_cos(angle);
        problem.solid[k].sine = riddle_sin(angle);
    }
    problem.volume = reduced_volume;
    double ratio = def->radius_i < def->radius_j ? def->radius_i / def->radius_j : def->radius_j / def->radius_i;
    problem.close = !problem.symmetric && ratio > 0.7 && def->angle_i > 0.45 && def->angle_j > 0.45;
    problem.step = 0.1;
    problem.work = 0;
    return problem;
}

static inline double bridge__share(const bridge__problem *problem, const bridge__meniscus *m) {
    double share = m->half[0].v[0] / problem->volume;
    return share > 0.0 ? (share < 1.0 ? share : 1.0) : 0.0;
}

static inline void bridge__describe(const bridge_pair_def *def, const bridge__problem *problem,
                                    const bridge__meniscus *m, bridge_shape *shape) {
    double R = bridge_harmonic_radius(def->radius_i, def->radius_j), sigma = def->liquid.surface_tension, ring[2],
           filling[2];
    double energy = m->half[0].area + m->half[1].area;
    for (int k = 0; k < 2; k++) {
        ring[k] = sqrt(m->half[k].ring2);
        filling[k] = riddle_asin(ring[k] * problem->solid[k].curvature);
        energy -= problem->solid[k].cosine * 2.0 * RIDDLE_PI * m->half[k].ring2 / (1.0 + riddle_cos(filling[k]));
    }
    shape->force = 2.0 * RIDDLE_PI * sigma * R * m->force;
    shape->pressure = sigma / R * m->pressure;
    shape->gap = m->gap * R;
    shape->neck = m->neck * R;
    shape->ring_i = ring[0] * R;
    shape->ring_j = ring[1] * R;
    shape->filling_i = filling[0];
    shape->filling_j = filling[1];
    shape->share_i = bridge__share(problem, m);
    shape->energy = energy * sigma * R * R;
    shape->stable = !(problem->symmetric && m->half[0].g[3] < 0.0);
}

/* Opens the bridge from contact to a gap: until the gap is passed, then back in from the near side, where Newton
   cannot overshoot. */
static inline bridge_status bridge__open(bridge__problem *problem, double gap, bridge__meniscus *m) {
    double step = problem->step;
    while (m->gap < gap) {
        bridge__meniscus before = *m, fold;
        bridge__aim aim;
        if (!bridge__open_a_little(problem, m, &step, &aim)) return BRIDGE_NO_SOLUTION;
        int folded = bridge__event(m, aim) >= 0.0;
        if (folded && !bridge__locate(problem, &before, m, aim, &fold)) return BRIDGE_NO_SOLUTION;
        if (folded && gap > fold.gap) return BRIDGE_RUPTURED;
        if (folded || m->gap >= gap) {
            *m = before;
            break;
        }
    }
    return bridge__newton(problem, m, BRIDGE__AT_GAP, gap) ? BRIDGE_OK : BRIDGE_NO_SOLUTION;
}

/* Sets all results to NaN, so that a failed solution is not taken for one. */
static inline void bridge__no_shape(bridge_shape *shape) {
    shape->force = shape->pressure = shape->gap = shape->neck = shape->ring_i = shape->ring_j = (double)NAN;
    shape->filling_i = shape->filling_j = shape->share_i = shape->energy = (double)NAN;
    shape->stable = 0;
}

BRIDGE_API bridge_status bridge_young_laplace(const bridge_pair_def *def, double volume, double gap,
                                              bridge_shape *shape) {
    if (!shape) return BRIDGE_INVALID;
    bridge__no_shape(shape);
    if (bridge_pair_check_def(def, NULL) != BRIDGE_OK || !(volume > 0.0) || !(gap >= 0.0)) return BRIDGE_INVALID;
    double R = bridge_harmonic_radius(def->radius_i, def->radius_j);
    bridge__problem problem = bridge__problem_of(def, volume / R / R / R);
    bridge__meniscus contact, m;
    bridge_status status = BRIDGE_NO_SOLUTION;
    if (!(problem.volume >= 1e-9 && problem.volume <= 1.0) || !bridge__in_contact(&problem, &contact))
        return BRIDGE_NO_SOLUTION;
    for (int attempt = 0; attempt < 3 && status == BRIDGE_NO_SOLUTION; attempt++, problem.step *= 0.2) {
        m = contact;
        status = bridge__open(&problem, gap / R, &m);
    }
    if (status != BRIDGE_OK) return status;
    bridge__describe(def, &problem, &m, shape);
    shape->gap = gap;
    return BRIDGE_OK;
}

BRIDGE_API bridge_status bridge_young_laplace_rupture(const bridge_pair_def *def, double volume, bridge_shape *shape,
                                                      double *fold_gap) {
    if (!shape) return BRIDGE_INVALID;
    bridge__no_shape(shape);
    if (fold_gap) *fold_gap = (double)NAN;
    if (bridge_pair_check_def(def, NULL) != BRIDGE_OK || !(volume > 0.0)) return BRIDGE_INVALID;
    double R = bridge_harmonic_radius(def->radius_i, def->radius_j);
    bridge__problem problem = bridge__problem_of(def, volume / R / R / R);
    bridge__meniscus m, rupture, fold;
    if (!(problem.volume >= 1e-9 && problem.volume <= 1.0) || !bridge__in_contact(&problem, &m))
        return BRIDGE_NO_SOLUTION;
    rupture = fold = m;
    if (!bridge__follow(&problem, &m, &rupture, &fold)) return BRIDGE_NO_SOLUTION;
    bridge__describe(def, &problem, &rupture, shape);
    if (fold_gap) *fold_gap = fold.gap * R;
    return BRIDGE_OK;
}

/* >>pair: tables --------------------------------------------------------------------------------------------------- */

#define BRIDGE__COOKIE 0xB51D6E01u
#define BRIDGE__SAMPLES 24 /* points of one volume's force curve, for seven coefficients */

BRIDGE_API bridge_pair_def bridge_pair_default_def(void) {
    bridge_pair_def def;
    def.radius_i = def.radius_j = 2.5e-3;
    def.angle_i = def.angle_j = 15.0 / 180.0 * RIDDLE_PI;
    def.volume_min = 1e-6;
    def.volume_max = 0.1;
    def.liquid.surface_tension = 0.07275;
    def.liquid.viscosity = 1.002e-3;
    def.liquid.roughness = 1e-3;
    def.split = BRIDGE_SPLIT_NECK;
    def.cookie = BRIDGE__COOKIE;
    return def;
}

BRIDGE_API bridge_status bridge_pair_check_def(const bridge_pair_def *def, const char **field) {
    if (field) *field = def ? NULL : "def";
    if (!def) return BRIDGE_INVALID;
    const bridge_liquid *liquid = &def->liquid;
    const char *bad = NULL;
    if (def->cookie != BRIDGE__COOKIE) bad = "cookie";
    else if (!(def->radius_i > 0.0 && bridge__is_finite(def->radius_i))) bad = "radius_i";
    else if (!(def->radius_j > 0.0)) bad = "radius_j";
    else if (!(def->radius_i / def->radius_j <= 1e6 &&
               (def->radius_i / def->radius_j >= 1e-6 || !bridge__is_finite(def->radius_j))))
        bad = "radius_j";
    else if (!(def->angle_i >= 0.0 && def->angle_i <= 1.05)) bad = "angle_i";
    else if (!(def->angle_j >= 0.0 && def->angle_j <= 1.05)) bad = "angle_j";
    else if (!(def->volume_min >= 1e-8)) bad = "volume_min";
    else if (!(def->volume_max >= 2.0 * def->volume_min && def->volume_max <= 0.15)) bad = "volume_max";
    else if (!(liquid->surface_tension > 0.0 && bridge__is_finite(liquid->surface_tension)))
        bad = "liquid.surface_tension";
    else if (!(liquid->viscosity >= 0.0 && bridge__is_finite(liquid->viscosity))) bad = "liquid.viscosity";
    else if (!(liquid->roughness >= 2e-4 && liquid->roughness <= 0.1)) bad = "liquid.roughness";
    else if (def->split != BRIDGE_SPLIT_NECK && def->split != BRIDGE_SPLIT_HALF && def->split != BRIDGE_SPLIT_RETURN)
        bad = "split";
    if (field) *field = bad;
    return bad ? BRIDGE_INVALID : BRIDGE_OK;
}

/* Force over 2 pi sigma R_h and tau/sqrt(S_rup) at the samples from contact (k = 0) towards rupture of one volume. */
typedef struct bridge__curve {
    double gap[BRIDGE__SAMPLES], force[BRIDGE__SAMPLES], tau[BRIDGE__SAMPLES], rupture_gap, share;
} bridge__curve;

static inline int bridge__sample(bridge__problem *problem, const bridge__meniscus *contact,
                                 const bridge__meniscus *rupture, bridge__curve *curve) {
    bridge__meniscus m = *contact;
    for (int k = 0; k < BRIDGE__SAMPLES; k++) { /* Chebyshev points in ln y0: dense at both ends */
        double at = 0.5 - 0.5 * riddle_cos(RIDDLE_PI * (k + 0.5) / BRIDGE__SAMPLES);
        double target = contact->z[1] + (rupture->z[1] - contact->z[1]) * at;
        while (m.z[1] - target > problem->step)
            if (!bridge__advance(problem, &m, BRIDGE__AT_NECK, m.z[1] - problem->step)) return 0;
        if (!bridge__advance(problem, &m, BRIDGE__AT_NECK, target)) return 0;
        if (k > 0 && !(m.gap > curve->gap[k - 1] && m.gap < rupture->gap && m.force > 0.0)) return 0;
        curve->gap[k] = m.gap;
        curve->force[k] = m.force;
        curve->tau[k] = sqrt(1.0 - m.gap / rupture->gap);
    }
    return 1;
}
/* Follows the family of bridges from contact to rupture and samples it. Tries up to three step sizes: for nearly equal
   spheres a long step may pass the fold and find another. */
static inline int bridge__curve_solve(bridge__problem *problem, bridge__curve *curve) {
    bridge__meniscus contact, rupture;
    if (!bridge__in_contact(problem, &contact)) return 0;
    for (int attempt = 0; attempt < 3; attempt++, problem->step *= 0.2) {
        if (!bridge__follow(problem, &contact, &rupture, NULL)) return 0;
        curve->rupture_gap = rupture.gap;
        curve->share = bridge__share(problem, &rupture);
        if (bridge__sample(problem, &contact, &rupture, curve)) return 1;
    }
    return 0;
}

/* Fits force/X by a polynomial in tau, by least relative squares: *series receives the coefficients of tau^k. */
static inline int bridge__curve_fit(const bridge__problem *problem, const bridge__curve *curve, double *series) {
    enum { N = BRIDGE_SERIES };
    double a[N * (N + 1)], area = 2.0 / RIDDLE_PI * problem->volume;
    for (int i = 0; i < N * (N + 1); i++) a[i] = 0.0;
    for (int k = 0; k < BRIDGE__SAMPLES; k++) {
        double weight = riddle_sin(RIDDLE_PI * (k + 0.5) / BRIDGE__SAMPLES), x = 2.0 * curve->tau[k] - 1.0, t[N];
        double scale = bridge_neck_factor(curve->gap[k], area) / curve->force[k];
        t[0] = scale;
        t[1] = scale * x;
        for (int i = 2; i < N; i++) t[i] = 2.0 * x * t[i - 1] - t[i - 2];
        for (int i = 0; i < N; i++) {
            for (int j = 0; j < N; j++) a[i * (N + 1) + j] += weight * t[i] * t[j];
            a[i * (N + 1) + N] += weight * t[i];
        }
    }
    if (!bridge__solve(a, N, N + 1)) return 0;
    double p[N], q[N]; /* T_(i-1) and T_i(2 tau - 1) in powers of tau */
    for (int j = 0; j < N; j++) {
        p[j] = j == 0 ? 1.0 : 0.0;
        q[j] = j == 0 ? -1.0 : (j == 1 ? 2.0 : 0.0);
        series[j] = a[N] * p[j] + a[(N + 1) + N] * q[j];
    }
    for (int i = 2; i < N; i++)
        for (int j = N - 1; j >= 0; j--) {
            double next = 4.0 * (j > 0 ? q[j - 1] : 0.0) - 2.0 * q[j] - p[j];
            p[j] = q[j]; /* q[j - 1], read next, is still the old one: j falls */
            q[j] = next;
            series[j] += a[i * (N + 1) + N] * next;
        }
    return 1;
}

/* Series of b for its volume, from the table. */
static inline void bridge__contract(const bridge_pair *pair, bridge *b) {
    double R = b->radius, reduced = b->volume / R / R / R, value[BRIDGE_SERIES + 2];
    double ln_volume = riddle_log(reduced);
    int piece = 0;
    while (piece + 1 < BRIDGE_PIECES && piece + 1 < pair->pieces && ln_volume > pair->ln_edge[piece + 1]) piece++;
    double low = pair->ln_edge[piece], high = pair->ln_edge[piece + 1],
           u = (2.0 * ln_volume - low - high) / (high - low);
    const double(*table)[BRIDGE_NODES] = pair->table[piece];
    for (int r = 0; r < BRIDGE_SERIES + 2; r++) { /* Clenshaw */
        double next = 0.0, after = 0.0;
        for (int k = BRIDGE_NODES - 1; k > 0; k--) {
            double now = table[r][k] + 2.0 * u * next - after;
            after = next;
            next = now;
        }
        value[r] = table[r][0] + u * next - after;
    }
    b->width = sqrt(bridge_neck_area(b->volume, R));
    b->rupture_gap = riddle_cbrt(b->volume) * riddle_exp(value[BRIDGE_SERIES]);
    double share = value[BRIDGE_SERIES + 1], scale = 2.0 * RIDDLE_PI * pair->def.liquid.surface_tension * R,
           inverse = 1.0 / sqrt(b->rupture_gap);
    b->split = share > 0.0 ? (share < 1.0 ? share : 1.0) : 0.0;
    for (int k = 0; k < BRIDGE_SERIES; k++, scale *= inverse) b->series[k] = value[k] * scale;
}

/* Returns ln of the reduced volume whose larger half-filling angle in contact is 30 degrees; HUGE_VAL if
   there is none. */
static inline double bridge__pendular_limit(const bridge_pair_def *def) {
    double lo = riddle_log(1e-3), hi = riddle_log(def->volume_max);
    if (!(hi > lo)) return HUGE_VAL;
    for (int i = 0; i < 28; i++) {
        double at = i == 0 ? hi : 0.5 * (lo + hi);
        bridge__problem problem = bridge__problem_of(def, riddle_exp(at));
        bridge__meniscus m;
        if (!bridge__in_contact(&problem, &m)) return HUGE_VAL;
        double si = sqrt(m.half[0].ring2) * problem.solid[0].curvature,
               sj = sqrt(m.half[1].ring2) * problem.solid[1].curvature;
        if ((si > sj ? si : sj) < 0.5) {
            if (i == 0) return HUGE_VAL;
            lo = at;
        } else {
            hi = at;
        }
    }
    return hi;
}

/* Tabulates the volumes of one piece. */
static inline bridge_status bridge__tabulate(bridge_pair *pair, int piece) {
    double low = pair->ln_edge[piece], high = pair->ln_edge[piece + 1];
    for (int r = 0; r < BRIDGE_SERIES + 2; r++)
        for (int k = 0; k < BRIDGE_NODES; k++) pair->table[piece][r][k] = 0.0;
    for (int m = 0; m < BRIDGE_NODES; m++) {
        double u = riddle_cos(RIDDLE_PI * (m + 0.5) / BRIDGE_NODES), value[BRIDGE_SERIES + 2];
        bridge__problem problem = bridge__problem_of(&pair->def, riddle_exp(0.5 * (low + high + u * (high - low))));
        bridge__curve curve;
        if (!bridge__curve_solve(&problem, &curve) || !bridge__curve_fit(&problem, &curve, value))
            return BRIDGE_NO_SOLUTION;
        value[BRIDGE_SERIES] = riddle_log(curve.rupture_gap / riddle_cbrt(problem.volume));
        value[BRIDGE_SERIES + 1] = curve.share;
        for (int k = 0; k < BRIDGE_NODES; k++) {
            double weight = (k == 0 ? 1.0 : 2.0) / BRIDGE_NODES * riddle_cos(RIDDLE_PI * k * (m + 0.5) / BRIDGE_NODES);
            for (int r = 0; r < BRIDGE_SERIES + 2; r++) pair->table[piece][r][k] += weight * value[r];
        }
    }
    return BRIDGE_OK;
}

/* Raises the pair's deviations to those at one volume. */
static inline bridge_status bridge__compare(bridge_pair *pair, double ln_volume) {
    bridge__problem problem = bridge__problem_of(&pair->def, riddle_exp(ln_volume));
    bridge__curve curve;
    bridge b;
    b.volume = problem.volume;
    b.radius = 1.0;
    if (!bridge__curve_solve(&problem, &curve)) return BRIDGE_NO_SOLUTION;
    bridge__contract(pair, &b);
    for (int k = 0; k < BRIDGE__SAMPLES && curve.gap[k] <= 0.9 * curve.rupture_gap; k++) {
        double exact = 2.0 * RIDDLE_PI * pair->def.liquid.surface_tension * curve.force[k];
        double deviation = fabs(bridge_attraction(&b, curve.gap[k]) / exact - 1.0);
        if (!(deviation <= pair->deviation)) pair->deviation = deviation;
    }
    double deviation = fabs(b.rupture_gap / curve.rupture_gap - 1.0);
    if (!(deviation <= pair->rupture_deviation)) pair->rupture_deviation = deviation;
    return BRIDGE_OK;
}

/* Compares every piece at its ends and at three volumes between each two nodes, where interpolation is worst.
   Within 0.5 % of a jump a volume may stay unsolved: it is passed over. */
static inline void bridge__compare_all(bridge_pair *pair) {
    enum { PARTS = 4 };
    pair->deviation = pair->rupture_deviation = 0.0;
    for (int piece = 0; piece < pair->pieces; piece++) {
        double low = pair->ln_edge[piece], high = pair->ln_edge[piece + 1];
        for (int k = 0; k <= PARTS * BRIDGE_NODES; k++) {
            if (k % PARTS == PARTS / 2) continue; /* a node */
            double u = -riddle_cos(RIDDLE_PI * k / (PARTS * BRIDGE_NODES));
            (void)bridge__compare(pair, 0.5 * (low + high + u * (high - low)));
        }
    }
    pair->deviation *= 1.25; /* the largest deviation is between the volumes compared */
    pair->rupture_deviation *= 1.25;
}

/* Returns the share of the liquid that stays on i at rupture; NaN if there is no solution. */
static inline double bridge__share_at(const bridge_pair_def *def, double ln_volume) {
    bridge__problem problem = bridge__problem_of(def, riddle_exp(ln_volume));
    bridge__meniscus contact, rupture;
    if (!bridge__in_contact(&problem, &contact) || !bridge__follow(&problem, &contact, &rupture, NULL))
        return (double)NAN;
    return bridge__share(&problem, &rupture);
}

/* Returns ln of the volume at which the share at rupture changes fastest: takes the steepest of some intervals and
   halves it repeatedly towards its steeper half. */
static inline double bridge__jump(const bridge_pair *pair) {
    enum { PARTS = 24 };
    double width = (pair->ln_max - pair->ln_min) / (double)PARTS, before = bridge__share_at(&pair->def, pair->ln_min),
           low = pair->ln_min, low_share = before, high_share = before, steepest = -1.0;
    for (int k = 1; k <= PARTS; k++) {
        double share = bridge__share_at(&pair->def, pair->ln_min + k * width);
        if (fabs(share - before) > steepest) {
            steepest = fabs(share - before);
            low = pair->ln_min + (k - 1) * width;
            low_share = before;
            high_share = share;
        }
        before = share;
    }
    for (int k = 0; k < 12; k++) {
        width *= 0.5;
        double middle = bridge__share_at(&pair->def, low + width);
        if (fabs(middle - low_share) >= fabs(high_share - middle)) {
            high_share = middle;
        } else {
            low += width;
            low_share = middle;
        }
    }
    return low + 0.5 * width;
}

/* Cuts the table at a jump of the neck, and again close to it on either side. */
static inline int bridge__cut(bridge_pair *pair) {
    double jump = bridge__jump(pair), below = jump - pair->ln_min, above = pair->ln_max - jump;
    if (!(below > 0.02 && above > 0.02)) return 0;
    pair->pieces = BRIDGE_PIECES;
    pair->ln_edge[1] = jump - (below > 1.0 ? 0.2 : 0.2 * below);
    pair->ln_edge[2] = jump;
    pair->ln_edge[3] = jump + (above > 1.0 ? 0.2 : 0.2 * above);
    pair->ln_edge[4] = pair->ln_max;
    return 1;
}

BRIDGE_API bridge_status bridge_pair_prepare(bridge_pair *pair, const bridge_pair_def *def) {
    const double few = 1e-3; /* a rupture gap off by more has a jump within the table */
    if (!pair) return BRIDGE_INVALID;
    pair->cookie = 0;
    if (bridge_pair_check_def(def, NULL) != BRIDGE_OK) return BRIDGE_INVALID;
    pair->def = *def;
    pair->radius = bridge_harmonic_radius(def->radius_i, def->radius_j);
    pair->ln_edge[0] = pair->ln_min = riddle_log(def->volume_min);
    pair->ln_max = riddle_log(def->volume_max);
    for (int k = 1; k <= BRIDGE_PIECES; k++) pair->ln_edge[k] = pair->ln_max;
    pair->pieces = 1;
    bridge_status status = bridge__tabulate(pair, 0);
    if (status != BRIDGE_OK) return status;
    bridge__compare_all(pair);
    if (pair->rupture_deviation > few && bridge__cut(pair)) {
        for (int piece = 0; piece < pair->pieces && status == BRIDGE_OK; piece++)
            status = bridge__tabulate(pair, piece);
        if (status != BRIDGE_OK) { /* a volume at the jump cannot be solved: use the table in one, which states its
                                      error */
            pair->pieces = 1;
            pair->ln_edge[1] = pair->ln_max;
            if (bridge__tabulate(pair, 0) != BRIDGE_OK) return BRIDGE_NO_SOLUTION;
        }
        bridge__compare_all(pair);
    }
    pair->cookie = BRIDGE__COOKIE;
    pair->pendular_volume = riddle_exp(bridge__pendular_limit(def));
    return BRIDGE_OK;
}

static inline void bridge__clear(bridge *b) {
    b->volume = b->width = b->rupture_gap = b->radius = b->split = 0.0;
    for (int k = 0; k < BRIDGE_SERIES; k++) b->series[k] = 0.0;
}

BRIDGE_API void bridge_volume_range(const bridge_pair *pair, double radius_i, double radius_j, double *smallest,
                                    double *largest) {
    if (!(smallest && largest)) return;
    *smallest = *largest = bridge__nan();
    if (!pair) return;
    double R = bridge_harmonic_radius(radius_i, radius_j);
    *smallest = pair->def.volume_min * R * R * R;
    *largest = pair->def.volume_max * R * R * R;
}

BRIDGE_API bridge_status bridge_form(const bridge_pair *pair, double radius_i, double radius_j, double given_i,
                                     double given_j, int swapped, bridge *b) {
    if (!(pair && b)) return BRIDGE_INVALID;
    bridge__clear(b);
    if (pair->cookie != BRIDGE__COOKIE) return BRIDGE_INVALID;
    double smallest, largest, volume = given_i + given_j;
    bridge_volume_range(pair, radius_i, radius_j, &smallest, &largest);
    if (!(given_i >= 0.0 && given_j >= 0.0 && smallest > 0.0)) return BRIDGE_INVALID;
    /* what bridge_allocate has capped may be off by a rounding */
    if (!(volume >= smallest * (1.0 - 1e-12) && volume <= largest * (1.0 + 1e-12))) return BRIDGE_VOLUME;
    b->volume = volume;
    b->radius = bridge_harmonic_radius(radius_i, radius_j);
    bridge__contract(pair, b);
    if (swapped) b->split = 1.0 - b->split;
    if (pair->def.split == BRIDGE_SPLIT_HALF) b->split = 0.5;
    if (pair->def.split == BRIDGE_SPLIT_RETURN) b->split = given_i / volume;
    return BRIDGE_OK;
}

BRIDGE_API bridge_status bridge_form_printed(const bridge_pair *pair, double radius_i, double radius_j, double given_i,
                                             double given_j, int swapped, bridge *b) {
    if (!(pair && b)) return BRIDGE_INVALID;
    bridge_status status = bridge_form(pair, radius_i, radius_j, given_i, given_j, swapped, b);
    if (status != BRIDGE_OK) return status;
    double ratio = radius_i < radius_j ? radius_i / radius_j : radius_j / radius_i;
    b->rupture_gap = bridge_rupture_gap(b->volume, b->radius, ratio, pair->def.angle_i, pair->def.angle_j);
    return BRIDGE_OK;
}

BRIDGE_API int bridge_is_pendular(const bridge_pair *pair, const bridge *b) {
    if (!(pair && b)) return 0;
    return b->volume <= pair->pendular_volume * b->radius * b->radius * b->radius;
}

BRIDGE_API const char *bridge_outside_text(unsigned flag) {
    switch (flag) {
#define BRIDGE__TEXT(name, value, text)                                                                                \
    case value: return text;
        BRIDGE_OUTSIDES(BRIDGE__TEXT)
#undef BRIDGE__TEXT
    }
    return "unknown flag";
}

/* Returns whether two solids have the same ratio of radii, to 4 %; a plate, of infinite radius, only another plate. */
static inline int bridge__same_ratio(double ri, double rj, double wanted_i, double wanted_j) {
    if (ri == HUGE_VAL || rj == HUGE_VAL || wanted_i == HUGE_VAL || wanted_j == HUGE_VAL)
        return (ri == HUGE_VAL) == (wanted_i == HUGE_VAL) && (rj == HUGE_VAL) == (wanted_j == HUGE_VAL);
    const double off = (ri / rj) / (wanted_i / wanted_j);
    return off <= 1.04 && off >= 1.0 / 1.04;
}

BRIDGE_API unsigned bridge_outside(const bridge_pair *pair, double radius_i, double radius_j, double volume) {
    const double degree = RIDDLE_PI / 180.0;
    if (!pair || pair->cookie != BRIDGE__COOKIE) return BRIDGE_OUTSIDE_NOTHING;
    const bridge_pair_def *d = &pair->def;
    const double R = bridge_harmonic_radius(radius_i, radius_j), reduced = volume / (R * R * R);
    const double mean = bridge_effective_angle(d->angle_i, d->angle_j),
                 larger = d->angle_i > d->angle_j ? d->angle_i : d->angle_j;
    unsigned flags = BRIDGE_OUTSIDE_NOTHING;
    if (!(mean <= 50.0 * degree && reduced >= 5e-5 && reduced <= 0.2)) flags |= BRIDGE_OUTSIDE_WILLETT;
    if (!(larger <= 50.0 * degree && reduced >= 1e-6 && reduced <= 0.1)) flags |= BRIDGE_OUTSIDE_UNEQUAL;
    if (!(reduced >= d->volume_min * (1.0 - 1e-12) && reduced <= d->volume_max * (1.0 + 1e-12)))
        flags |= BRIDGE_OUTSIDE_TABLE;
    if (!bridge__same_ratio(radius_i, radius_j, d->radius_i, d->radius_j)) flags |= BRIDGE_OUTSIDE_RADII;
    if (!(reduced <= pair->pendular_volume)) flags |= BRIDGE_OUTSIDE_PENDULAR;
    return flags;
}

BRIDGE_API double bridge_work(const bridge *b, double from, double to) {
    if (!b) return bridge__nan();
    if (!(b->volume > 0.0) || from != from || to != to) return from == from && to == to ? 0.0 : bridge__nan();
    if (from > to) return -bridge_work(b, to, from);
    double work = 0.0, a = b->width * b->width;
    if (from < 0.0) work += ((to < 0.0 ? to : 0.0) - from) * bridge_attraction(b, 0.0);
    double lo = from > 0.0 ? from : 0.0, hi = to < b->rupture_gap ? to : b->rupture_gap;
    /* dS = 2 tau dtau removes the root at rupture; four panels for the layer of thin bridges at contact */
    if (lo < hi) {
        double top = sqrt(b->rupture_gap - lo), bottom = sqrt(b->rupture_gap - hi), step = 0.25 * (top - bottom);
        for (int panel = 0; panel < 4; panel++)
            for (int i = 0; i < 32; i++) {
                const double *node = bridge__gauss[i < 16 ? i : 31 - i];
                double tau = bottom + step * (panel + (i < 16 ? node[0] : 1.0 - node[0]));
                work += step * node[1] * 2.0 * tau * bridge_attraction(b, b->rupture_gap - tau * tau);
            }
    }
    if (to > b->rupture_gap) { /* c0 times the integral of X, S - h = -a/(S + h) */
        double start = from > b->rupture_gap ? from : b->rupture_gap;
        work += b->series[0] * (a / (start + sqrt(start * start + a)) - a / (to + sqrt(to * to + a)));
    }
    return work;
}

BRIDGE_API bridge_stiffness bridge_contact_stiffness(const bridge *b, const bridge_liquid *liquid) {
    bridge_stiffness stiffness = {0.0, 0.0, 0.0};
    if (!(b && liquid && b->volume > 0.0)) return stiffness;
    /* F = X P(tau) at S = 0: X = 1, dX/dS = -1/sqrt(a), dtau/dS = -1/(2 tau) */
    double tau = sqrt(b->rupture_gap), p = 0.0, dp = 0.0;
    for (int k = BRIDGE_SERIES - 1; k >= 0; k--) {
        dp = dp * tau + p;
        p = p * tau + b->series[k];
    }
    bridge_forces moving = bridge_evaluate(b, liquid, 0.0, 1.0);
    stiffness.capillary = p / b->width + 0.5 * dp / tau;
    stiffness.normal = moving.normal - bridge_attraction(b, 0.0);
    stiffness.tangential = moving.tangential;
    return stiffness;
}

/* >>books ---------------------------------------------------------------------------------------------------------- */

BRIDGE_API double bridge_quantum(double total) {
    int exponent;
    if (!(total > 0.0 && bridge__is_finite(total))) return bridge__nan();
    frexp(total, &exponent);
    return ldexp(1.0, exponent - 52);
}

/* Returns the index of the partner's film in `scratch`; n_particles + n_patches if it has none. */
static inline size_t bridge__slot(const bridge_films *films, size_t j, bridge_partner partner) {
    size_t none = films->n_particles + films->n_patches;
    if (partner == BRIDGE_SPHERE) return j < films->n_particles ? j : none;
    return j < films->n_patches ? films->n_particles + j : none;
}

static inline double *bridge__film(const bridge_films *films, size_t slot) {
    return slot < films->n_particles ? &films->particle[slot] : &films->patch[slot - films->n_particles];
}

BRIDGE_API bridge_status bridge_allocate(bridge_films *films, bridge_contact *contacts, size_t n) {
    if (!films || (n > 0 && !contacts) || !(films->quantum > 0.0 && bridge__is_finite(films->quantum)))
        return BRIDGE_INVALID;
    size_t none = films->n_particles + films->n_patches;
    if (!(films->quantum > 0.0)) return BRIDGE_INVALID;
    for (size_t k = 0; k < n; k++) {
        const bridge_contact *c = &contacts[k];
        if (c->i >= films->n_particles || bridge__slot(films, c->j, c->partner) == none) return BRIDGE_INVALID;
        if (!(c->radius_i > 0.0 && bridge__is_finite(c->radius_i) && c->volume_min >= 0.0 &&
              c->volume_max >= c->volume_min))
            return BRIDGE_INVALID;
        if (c->partner != BRIDGE_WALL && !(c->radius_j > 0.0)) return BRIDGE_INVALID;
        if (c->partner == BRIDGE_SPHERE && (c->i == c->j || !bridge__is_finite(c->radius_j))) return BRIDGE_INVALID;
        if (c->partner == BRIDGE_WIRE && !(c->radius_j <= 6.0 * c->radius_i)) return BRIDGE_INVALID;
    }
    for (size_t k = 0; k < n; k++)
        films->scratch[contacts[k].i] = films->scratch[bridge__slot(films, contacts[k].j, contacts[k].partner)] = 0.0;
    for (size_t k = 0; k < n; k++) { /* first pass: the request of each bridge, in multiples of the quantum, so that
                                        sums do not depend on the order */
        bridge_contact *c = &contacts[k];
        size_t j = bridge__slot(films, c->j, c->partner);
        double film = films->particle[c->i], other = *bridge__film(films, j);
        if (c->partner == BRIDGE_SPHERE) {
            c->given_i = bridge_share_sphere(film, c->radius_i, c->radius_j);
            c->given_j = bridge_share_sphere(other, c->radius_j, c->radius_i);
        } else {
            double thickness = other / films->patch_area[c->j];
            int wall = c->partner == BRIDGE_WALL;
            c->given_i = wall ? bridge_share_wall(film) : bridge_share_wire(film, c->radius_i, c->radius_j);
            c->given_j = wall ? bridge_share_wall_film(thickness, c->radius_i)
                              : bridge_share_wire_film(thickness, c->radius_i, c->radius_j);
        }
        double volume = c->given_i + c->given_j, cap = volume > c->volume_max ? c->volume_max / volume : 1.0;
        c->given_i = bridge_quantised(c->given_i * cap, films->quantum);
        c->given_j = bridge_quantised(c->given_j * cap, films->quantum);
        films->scratch[c->i] += c->given_i;
        films->scratch[j] += c->given_j;
    }
    for (size_t k = 0; k < n; k++) { /* demand becomes the fraction that can be met, marked as done by its sign */
        size_t slot[2] = {contacts[k].i, bridge__slot(films, contacts[k].j, contacts[k].partner)};
        for (int side = 0; side < 2; side++) {
            double demand = films->scratch[slot[side]], film = *bridge__film(films, slot[side]);
            if (demand >= 0.0) films->scratch[slot[side]] = demand > film ? -(film / demand) : -1.0;
        }
    }
    for (size_t k = 0; k < n; k++) { /* second pass: give */
        bridge_contact *c = &contacts[k];
        size_t j = bridge__slot(films, c->j, c->partner);
        double *film_i = &films->particle[c->i], *film_j = bridge__film(films, j);
        double give_i = bridge_quantised(-films->scratch[c->i] * c->given_i, films->quantum);
        double give_j = bridge_quantised(-films->scratch[j] * c->given_j, films->quantum);
        give_i = give_i < *film_i ? give_i : *film_i; /* film/demand may round up: never below an empty film */
        give_j = give_j < *film_j ? give_j : *film_j;
        if (!(give_i + give_j > 0.0 && give_i + give_j >= c->volume_min)) give_i = give_j = 0.0;
        c->given_i = give_i;
        c->given_j = give_j;
        *film_i -= give_i;
        *film_j -= give_j;
    }
    return BRIDGE_OK;
}

BRIDGE_API bridge_status bridge_release(bridge_films *films, bridge *b, size_t i, size_t j, bridge_partner partner) {
    if (!(films && b && b->volume >= 0.0 && bridge__is_finite(b->volume) && b->split >= 0.0 && b->split <= 1.0))
        return BRIDGE_INVALID;
    size_t slot = bridge__slot(films, j, partner);
    if (i >= films->n_particles || slot == films->n_particles + films->n_patches) return BRIDGE_INVALID;
    if (!(films->quantum > 0.0 && bridge__is_finite(films->quantum))) return BRIDGE_INVALID;
    double to_i = bridge_split_volume(b, films->quantum);
    films->particle[i] += to_i;
    *bridge__film(films, slot) += b->volume - to_i;
    bridge__clear(b);
    return BRIDGE_OK;
}

BRIDGE_API double bridge_add(bridge_films *films, double *film, double amount) {
    if (!(films && film && films->quantum > 0.0 && bridge__is_finite(films->quantum))) return bridge__nan();
    double added = bridge_quantised(amount, films->quantum);
    if (!(added >= 0.0 && bridge__is_finite(added))) return bridge__nan();
    *film += added;
    films->added += added;
    return added;
}

BRIDGE_API double bridge_evaporate(bridge_films *films, double *film, double amount) {
    if (!(films && film && films->quantum > 0.0 && bridge__is_finite(films->quantum))) return bridge__nan();
    double taken = bridge_quantised(amount < *film ? amount : *film, films->quantum);
    if (!(amount >= 0.0 && taken >= 0.0)) return bridge__nan();
    *film -= taken;
    films->evaporated += taken;
    return taken;
}

BRIDGE_API double bridge_evaporate_bridge(bridge_films *films, const bridge_pair *pair, bridge *b, double amount) {
    if (!(films && pair && b && films->quantum > 0.0 && bridge__is_finite(films->quantum))) return bridge__nan();
    double left = b->volume - bridge_quantised(amount, films->quantum), taken = b->volume - left, split = b->split,
           R = b->radius;
    if (!(amount >= 0.0)) return bridge__nan();
    if (!(b->volume > 0.0 && left >= pair->def.volume_min * R * R * R)) return 0.0;
    b->volume = left;
    bridge__contract(pair, b);
    b->split = split;
    films->evaporated += taken;
    return taken;
}

BRIDGE_API double bridge_sum(const double *values, size_t n, size_t stride) {
    if ((!values || stride < 1) && n > 0) return bridge__nan();
    double sum = 0.0, lost = 0.0;
    for (size_t k = 0; k < n; k++) {
        double value = values[k * stride], next = sum + value;
        lost += fabs(sum) >= fabs(value) ? (sum - next) + value : (value - next) + sum;
        sum = next;
    }
    return sum + lost;
}

BRIDGE_API double bridge_films_total(const bridge_films *films) {
    if (!films) return bridge__nan();
    return bridge_sum(films->particle, films->n_particles, 1) + bridge_sum(films->patch, films->n_patches, 1);
}

#endif /* BRIDGE__BODIES */

#ifdef __cplusplus
}
#endif
#endif /* RIDDLE_LIQUID_BRIDGE_H */
