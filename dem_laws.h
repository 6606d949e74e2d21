/* dem_laws.h: more contact laws for dem.h: rolling with a spring, adhesion, bonds. Each is a user law: copy one and
   change it.

   #include "dem_laws.h"

   // once, outside of functions: compiles the law's loop
   DEM_KERNEL(kernel, contact_jkr, DEM_HERTZ | DEM_FRICTION)

   int main(void) {
       dem_def def = dem_default_def();
       const int powder = dem_add_material(&def, 1500.0, 1e8, 0.3);
       contact_laws laws = contact_default_laws();
       contact_pair(&laws, powder, powder)->surface_energy = 0.05;     // [J/m2]
       def.dt = 1e-7;
       dem_world world;
       if (dem_init(&world, &def, NULL) != DEM_OK) return 1;
       world.user = &laws;                                             // without it a run gives DEM_NOT_FINITE
       dem_feed feed = dem_default_feed();                             // spheres of 1 mm
       dem_fill(&world, &feed, 20);
       const dem_status status = dem_run_law(&world, 1e-5, &kernel);
       dem_free(&world);
       return status != DEM_OK;
   }

   Models, with the features to name to DEM_KERNEL (and DEM_ENERGY for the ledger):
   contact_epsd        linear, friction, rolling by an elastic-plastic spring and dashpot (Ai, Chen, Rotter & Ooi 2011,
                       model C), and twisting by the same scheme; DEM_LINEAR | DEM_FRICTION | DEM_ROLLING
   contact_epsd_hertz  the same on Hertz-Mindlin; DEM_HERTZ | DEM_FRICTION | DEM_ROLLING
   contact_dmt         Hertz-Mindlin with the pull of Derjaguin, Muller & Toporov (1975): stiff, small, weakly adhesive
                       spheres; DEM_HERTZ | DEM_FRICTION
   contact_jkr         the contact of Johnson, Kendall & Roberts (1971): soft, large, strongly adhesive spheres;
                       DEM_HERTZ | DEM_FRICTION
   contact_bonds       parallel bonds of Potyondy & Cundall (2004) that bend, twist and break, and linear friction where
                       there is none; DEM_LINEAR | DEM_FRICTION | DEM_ROLLING

   Pairs    restitution, friction and stiffness come from dem_pair(), the rest from contact_pair(). An instance of
            contact_laws must outlive the runs. It is no part of dem_save(): set world.user again after dem_load().
   Units    SI.
   Memory   none. Threads: those of dem.h. Bits: as dem.h.
   Linking  with dem.h beside it. Every function is static inline; for one shared copy #define CONTACT_API extern before
            every inclusion, and CONTACT_IMPLEMENTATION as well in one file; laws stay static inline, and dem.h has its
            own switch.
   Not here polyhedra with torque about the normal, sintering, liquid (dem_wet.h). docs/contact_laws.md has
   equations and checks. */
#ifndef RIDDLE_DEM_LAWS_H
#define RIDDLE_DEM_LAWS_H

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "dem_laws.h needs NaN and infinity: compile without -ffast-math"
#endif

#include "dem.h"

#include <float.h>
#include <math.h>
#include <string.h>

#ifndef CONTACT_API
#define CONTACT_API static inline
#define CONTACT__BODIES
#elif defined(CONTACT_IMPLEMENTATION)
#define CONTACT__BODIES
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ================================================= >>declarations ================================================= */

/* What the laws want of a pair of materials beside dem_pair_def. Zero: none of it. */
typedef struct contact_pair_def {
    double rolling;         /* coefficient of rolling friction mu_r [-] >= 0: greatest torque mu_r R* F_n; default 0 */
    double rolling_damping; /* share of the critical rolling damping eta_r [-] >= 0; default 0.3 */
    double twisting;        /* the same about the normal: greatest torque mu_t R* F_n [-] >= 0; 2/3 mu a/R* for a
                               contact of radius a that slides (Marshall 2009); default 0 */
    double surface_energy;  /* work of adhesion w, both surfaces together [J/m2] >= 0; contact_jkr,
                               contact_dmt; default 0 */
    double bond_modulus;    /* Young's modulus of a bond [Pa] >= 0; 0: this pair does not bond; default 0 */
    double bond_shear;      /* its shear stiffness over the normal one [-] >= 0; default 0.4 */
    double bond_radius;     /* its radius over the smaller sphere's [-] > 0; default 1 */
    double bond_damping;    /* share of the critical damping of its stretching [-] >= 0; default 0.1 */
    double tensile, shear;  /* strength in tension, in shear [Pa] > 0; default infinite */
} contact_pair_def;

typedef struct contact_laws {
    contact_pair_def pair[DEM_MATERIALS_MAX][DEM_MATERIALS_MAX]; /* [smaller index][larger index];
                                                                    contact_pair() finds it */
    int bonding; /* 1: contacts that begin now become bonds (contact_bonds). Set it, run 0 s, set it back to 0;
                    default 0. What touched before: contact_bond_touching() */
} contact_laws;

CONTACT_API contact_laws contact_default_laws(void);

/* The parameters of a pair of materials, in either order, to be edited; NULL if an index is out of range. */
CONTACT_API contact_pair_def *contact_pair(contact_laws *laws, int a, int b);

/* The first field outside its range, or NULL if all is well. */
CONTACT_API const char *contact_bad_field(const contact_laws *laws);

/* ---- pure laws of adhesion, NaN outside their domain. radius: R* = R_i R_j/(R_i + R_j), of a sphere on a plane its
   own [m] > 0;
        modulus: E* [Pa] > 0; energy: w [J/m2] >= 0 ---- */

CONTACT_API double contact_jkr_pull_off(double radius, double energy); /* [N], 1.5 pi w R */
CONTACT_API double contact_dmt_pull_off(double radius, double energy); /* [N], 2 pi w R */

/* Square root s of the contact radius: delta = a^2/R - sqrt(2 pi w a/E*) is s^4 - g s = x with x = R delta, g^2 = 2 pi
   w R^2/E*. Ferrari's larger root, in an order in which nothing cancels; x >= -3/4 g (g/4)^(1/3), where the
   two roots meet. */
DEM_INLINE double contact__jkr_root(double g, double x) {
    const double third = x / 3.0, inside = g * g * g * g / 256.0 + third * third * third;
    const double u = riddle_cbrt(g * g / 16.0 + sqrt(inside > 0.0 ? inside : 0.0)), square = u * u;
    const double d = 1.0 / (square + third + third * third / (square + 1e-300) + 1e-300), q = 0.5 * g * sqrt(d);
    const double rest = 4.0 / sqrt(d) - q * q;
    return 0.5 * (q + sqrt(rest > 0.0 ? rest : 0.0));
}
DEM_INLINE double contact__jkr_least(double g) { return -0.75 * g * riddle_cbrt(0.25 * g); }

/* Overlap, negative, at which a contact moved apart lets go [m]. */
CONTACT_API double contact_jkr_release(double radius, double modulus, double energy);
/* Contact radius [m] at an overlap [m]; NaN beyond the release. */
CONTACT_API double contact_jkr_radius(double radius, double modulus, double energy, double overlap);
/* Force [N] at a contact radius a >= 0 [m]: 4 E* a^3/(3 R) - sqrt(8 pi w E* a^3). */
CONTACT_API double contact_jkr_law(double radius, double modulus, double energy, double a);
/* Energy that an elastic JKR contact costs, from touching to release [J]: 7.09 (w^5 R^4/E*^2)^(1/3) (Thornton & Ning
   1998). With b = (2 pi w R^2/E*)^(1/3), the contact radius at zero overlap, the integral of the force is E* b^5/R^2
   times 8/15 z^5 - 4/3 z^(7/2) + 1/2 z^2 between z = 1 and z = 4^(-2/3), which is 3/10 + 4^(-4/3)/5. */
CONTACT_API double contact_jkr_work(double radius, double modulus, double energy);
/* Slowest normal impact from which bodies of effective mass m [kg] > 0 come apart again [m/s]. */
CONTACT_API double contact_jkr_sticking_speed(double radius, double modulus, double energy, double mass);

/* ============================================ >>rolling and twisting ============================================== */

/* These constants follow those of the shipped laws. */
enum { CONTACT_ROLL = DEM_LINEAR_CONSTANTS, CONTACT_ROLL_DAMPING, CONTACT_TWIST, CONTACT_EPSD_CONSTANTS };
/* [rad], [rad], contact radius of Hertz [m] */
enum { CONTACT_ANGLE = 3, CONTACT_TWISTED = 6, CONTACT_AREA, CONTACT_EPSD_STATES };

/* A spring of stiffness k [N m/rad] (before: in the last step) that yields at a torque `most`, and a dashpot while it
   does not. rate: of turning [rad/s]; angle: of the spring. Adds to torque, energy and losses. */
DEM_INLINE void contact__resist(const dem_contact *c, double k, double before, double most, double damping,
                                const double *rate, double *angle, dem_response *r) {
    double turned[3], size = 0.0;
    for (int a = 0; a < 3; a++) {
        turned[a] = angle[a] + rate[a] * c->dt;
        size += turned[a] * turned[a];
    }
    size = k * sqrt(size);
    const double scale = size > most ? most / size : 1.0, drag = size > most ? 0.0 : damping;
    for (int a = 0; a < 3; a++) {
        const double kept = scale * turned[a], work = 0.5 * (before * angle[a] + k * kept) * rate[a] * c->dt;
        r->slide_loss += 0.5 * before * angle[a] * angle[a] + work - 0.5 * k * kept * kept;
        r->elastic += 0.5 * k * kept * kept;
        r->rolling_power += drag * rate[a] * rate[a];
        r->rolling[a] -= k * kept + drag * rate[a];
        angle[a] = kept;
    }
}

/* Adds rolling and twisting resistance to an answer. stiffness: F_n over the overlap [N/m], now and before; angle,
   twisted: state. */
DEM_INLINE void contact_resist_turning(const dem_contact *c, double stiffness, double before, double *angle,
                                       double *twisted, dem_response *r) {
    const double *p = c->constants, *n = c->normal, *w = c->spin, push = r->contact > 0.0 ? r->contact : 0.0;
    const double along = w[0] * n[0] + w[1] * n[1] + w[2] * n[2];
    const double roll = 2.25 * p[CONTACT_ROLL] * p[CONTACT_ROLL], twist = 2.25 * p[CONTACT_TWIST] * p[CONTACT_TWIST];
    double about[3], across[3], turn[3];
    for (int a = 0; a < 3; a++) {
        about[a] = along * n[a];
        across[a] = w[a] - about[a];
        turn[a] = *twisted * n[a];
        r->rolling[a] = 0.0;
    }
    contact__resist(c, roll * stiffness, roll * before, p[CONTACT_ROLL] * push,
                    p[CONTACT_ROLL_DAMPING] * sqrt(roll * stiffness), across, angle, r);
    contact__resist(c, twist * stiffness, twist * before, p[CONTACT_TWIST] * push,
                    p[CONTACT_ROLL_DAMPING] * sqrt(twist * stiffness), about, turn, r);
    *twisted = turn[0] * n[0] + turn[1] * n[1] + turn[2] * n[2];
}

DEM_INLINE void contact_epsd_force(const dem_contact *c, double *state, dem_response *r) {
    dem_force_linear_friction(c, state, r);
    contact_resist_turning(c, c->constants[DEM__K], c->constants[DEM__K], state + CONTACT_ANGLE,
                           state + CONTACT_TWISTED, r);
}

DEM_INLINE void contact_epsd_hertz_force(const dem_contact *c, double *state, dem_response *r) {
    const double k = c->constants[DEM__HERTZ_K], before = state[CONTACT_AREA];
    /* The radius is no vector: here it stands behind the two that turn. */
    double mindlin[4] = {state[0], state[1], state[2], before};
    dem_force_hertz_friction(c, mindlin, r);
    for (int a = 0; a < 3; a++) state[a] = mindlin[a];
    state[CONTACT_AREA] = mindlin[3];
    contact_resist_turning(c, k * mindlin[3], k * before, state + CONTACT_ANGLE, state + CONTACT_TWISTED, r);
}

/* NaN if world.user was not set: the run then reports it. */
static inline contact_pair_def contact__pair_of(const dem_birth *b) {
    const contact_pair_def *p = contact_pair((contact_laws *)b->user, b->material_i, b->material_j);
    const contact_pair_def none = {(double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN,
                                   (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN};
    return p ? *p : none;
}
static inline double contact__radius(const dem_birth *b) {
    return 1.0 / (1.0 / b->radius_i + (b->radius_j > 0.0 ? 1.0 / b->radius_j : b->curvature));
}

/* Lever arms mu R*, and 2 eta sqrt(I_r): 1/I_r = 1/(I_i + m_i R_i^2) + 1/(I_j + m_j R_j^2) (Ai et al.). */
static inline void contact__prepare_turning(const dem_birth *b, double *constants) {
    const contact_pair_def pair = contact__pair_of(b);
    const double radius[2] = {b->radius_i, b->radius_j};
    const int material[2] = {b->material_i, b->material_j};
    double inverse = 0.0;
    for (int k = 0; k < (b->radius_j > 0.0 ? 2 : 1); k++) {
        const double volume = 4.0 / 3.0 * RIDDLE_PI * radius[k] * radius[k] * radius[k];
        inverse += 1.0 / (1.4 * b->def->material[material[k]].density * volume * radius[k] * radius[k]);
    }
    constants[CONTACT_ROLL] = pair.rolling * contact__radius(b);
    constants[CONTACT_TWIST] = pair.twisting * contact__radius(b);
    constants[CONTACT_ROLL_DAMPING] = 2.0 * pair.rolling_damping / sqrt(inverse);
}
static inline double contact_prepare_epsd(const dem_birth *b, double *constants) {
    contact__prepare_turning(b, constants);
    return dem_prepare_linear(b, constants);
}
static inline double contact_prepare_epsd_hertz(const dem_birth *b, double *constants) {
    contact__prepare_turning(b, constants);
    return dem_prepare_hertz(b, constants);
}

/* name, version, states, history, vectors, constants, prepare, force, born, ended */
static const dem_law contact_epsd = {"linear, EPSD rolling, twisting",
                                     1,
                                     CONTACT_AREA,
                                     CONTACT_AREA,
                                     2,
                                     CONTACT_EPSD_CONSTANTS,
                                     contact_prepare_epsd,
                                     contact_epsd_force,
                                     NULL,
                                     NULL};
static const dem_law contact_epsd_hertz = {"Hertz-Mindlin, EPSD rolling, twisting",
                                           1,
                                           CONTACT_EPSD_STATES,
                                           CONTACT_EPSD_STATES,
                                           2,
                                           CONTACT_EPSD_CONSTANTS,
                                           contact_prepare_epsd_hertz,
                                           contact_epsd_hertz_force,
                                           NULL,
                                           NULL};

/* =================================================== >>cohesion =================================================== */

enum {
    CONTACT_PULL = DEM_HERTZ_CONSTANTS,
    CONTACT_JKR_G,
    CONTACT_JKR_LEAST,
    CONTACT_JKR_TOUCHED,
    CONTACT_JKR_WORK,
    CONTACT_JKR_CONSTANTS
};

/* Of friction that counts a push, what remains where a pull leaves nothing of that. */
DEM_INLINE void contact__remain(dem_response *r, double pull, double push) {
    for (int a = 0; a < 3; a++) r->remaining[a] = push > pull ? r->tangential[a] * (pull / push) : r->tangential[a];
}

/* Hertz and a constant pull 2 pi w R* while surfaces overlap. The pull is a part of `contact`: it begins and ends with
   the overlap, and so has a share in the cut first and last step. Friction counts the repulsion of the solids. */
DEM_INLINE void contact_dmt_force(const dem_contact *c, double *state, dem_response *r) {
    const double pull = c->gap < 0.0 ? c->constants[CONTACT_PULL] : 0.0;
    dem_force_hertz_friction(c, state, r);
    contact__remain(r, pull, r->contact);
    r->contact -= pull;
    r->normal -= pull;
    r->elastic += pull * c->gap;
}
static inline double contact_prepare_dmt(const dem_birth *b, double *constants) {
    constants[CONTACT_PULL] = contact_dmt_pull_off(contact__radius(b), contact__pair_of(b).surface_energy);
    return dem_prepare_hertz(b, constants);
}

/* Hertz at the overlap a^2/R that has JKR's contact radius a, less the adhesion sqrt(8 pi w E* a^3): so damping and
   tangential stiffness follow the true contact. Friction up to mu (F + 2 F_c) (Thornton 1991), F_c the pull-off force.
   Alive until the release, beyond gap 0. */
DEM_INLINE void contact_jkr_force(const dem_contact *c, double *state, dem_response *r) {
    const double *p = c->constants, k = p[DEM__HERTZ_K], radius = p[DEM__HERTZ_RADIUS], x = -radius * c->gap;
    const double alive = x > p[CONTACT_JKR_LEAST] ? 1.0 : 0.0;
    const double s = contact__jkr_root(p[CONTACT_JKR_G], alive > 0.0 ? x : p[CONTACT_JKR_LEAST]), a = s * s;
    const double solid = k * a * a * a / radius, pull = alive * p[CONTACT_PULL] * s * a,
                 energy = p[CONTACT_PULL] * p[CONTACT_PULL] / (6.0 * k);
    double constants[DEM__HERTZ_CAP + 1];
    dem_contact hertz = *c;
    for (int n = 0; n <= DEM__HERTZ_CAP; n++) constants[n] = p[n];
    constants[DEM__HERTZ_MU] *= (solid - pull + energy * 3.0 * radius) / (solid + 1e-300);
    hertz.constants = constants;
    hertz.gap = -alive * a * a / radius;
    dem_force_hertz_friction(&hertz, state, r);
    contact__remain(r, pull, r->contact);
    r->contact -= pull;
    r->normal -= pull;
    r->elastic +=
        alive * (energy * a * a - 2.0 / 3.0 * p[CONTACT_PULL] * a * a * a * s / radius + p[CONTACT_JKR_TOUCHED]);
    r->slide_loss += (1.0 - alive) * p[CONTACT_JKR_WORK]; /* the energy stored at the release */
    r->ended = 1.0 - alive;
}
static inline double contact_prepare_jkr(const dem_birth *b, double *constants) {
    const double stiffness = dem_prepare_hertz(b, constants), modulus = 0.75 * constants[DEM__HERTZ_K];
    const double energy = contact__pair_of(b).surface_energy, radius = constants[DEM__HERTZ_RADIUS];
    constants[CONTACT_PULL] = sqrt(8.0 * RIDDLE_PI * energy * modulus);
    constants[CONTACT_JKR_G] = radius * sqrt(2.0 * RIDDLE_PI * energy / modulus);
    constants[CONTACT_JKR_LEAST] = contact__jkr_least(constants[CONTACT_JKR_G]);
    constants[CONTACT_JKR_WORK] = contact_jkr_work(radius, modulus, energy);
    /* Lost in touching. */
    constants[CONTACT_JKR_TOUCHED] = 0.3 / (0.3 + 0.2 / riddle_cbrt(256.0)) * constants[CONTACT_JKR_WORK];
    return stiffness;
}

static const dem_law contact_dmt = {"Hertz-Mindlin, DMT", 1,    4,   4, 1, CONTACT_JKR_G, contact_prepare_dmt,
                                    contact_dmt_force,    NULL, NULL};
static const dem_law contact_jkr = {"JKR", 1,   4, 4, 1, CONTACT_JKR_CONSTANTS, contact_prepare_jkr, contact_jkr_force,
                                    NULL,  NULL};

/* ==================================================== >>bonds ===================================================== */

/* Constants: stiffness of stretching, shearing [N/m], bending, twisting [N m/rad]; damping time [s]; 1/area and
   1/section modulus over the strengths, so that a bond breaks at 1. State: friction history, way sheared [m], angles
   bent and twisted [rad], 1 whole (2 new, 0 none), gap at birth [m]. */
enum {
    CONTACT_STRETCH = DEM_LINEAR_CONSTANTS,
    CONTACT_SHEAR,
    CONTACT_BEND,
    CONTACT_TORSION,
    CONTACT_LAG,
    CONTACT_TENSILE,
    CONTACT_SHEARED,
    CONTACT_FAR
};
enum { CONTACT_WAY = 3, CONTACT_BENT = 6, CONTACT_TURNED = 9, CONTACT_WHOLE, CONTACT_REST, CONTACT_BOND_STATES };

DEM_INLINE double contact__size(const double *v) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* While a bond is whole it carries everything; once broken, what overlaps is an ordinary contact. */
DEM_INLINE void contact_bond_force(const dem_contact *c, double *state, dem_response *r) {
    const double *p = c->constants, *n = c->normal, *w = c->spin, lag = p[CONTACT_LAG], was = state[CONTACT_WHOLE];
    const double rest = was > 1.5 ? c->gap : state[CONTACT_REST], stretch = c->gap - rest;
    const double along = w[0] * n[0] + w[1] * n[1] + w[2] * n[2], turned = state[CONTACT_TURNED] + along * c->dt;
    const double normal = -p[CONTACT_STRETCH] * stretch, torsion = p[CONTACT_TORSION] * turned;
    double dry[3] = {state[0], state[1], state[2]}, way[3], bent[3], shear[3], moment[3], rolling[3];
    double elastic = 0.5 * (p[CONTACT_STRETCH] * stretch * stretch + p[CONTACT_TORSION] * turned * turned);
    double power = p[CONTACT_TORSION] * along * along;
    dem_force_linear_friction(c, dry, r);
    for (int a = 0; a < 3; a++) {
        const double rate = w[a] - along * n[a];
        way[a] = state[CONTACT_WAY + a] + c->slip[a] * c->dt;
        bent[a] = state[CONTACT_BENT + a] + rate * c->dt;
        shear[a] = p[CONTACT_SHEAR] * way[a];
        moment[a] = p[CONTACT_BEND] * bent[a];
        rolling[a] = -moment[a] - torsion * n[a] - lag * (p[CONTACT_BEND] * rate + p[CONTACT_TORSION] * along * n[a]);
        elastic += 0.5 * (p[CONTACT_SHEAR] * way[a] * way[a] + p[CONTACT_BEND] * bent[a] * bent[a]);
        power += p[CONTACT_SHEAR] * c->slip[a] * c->slip[a] + p[CONTACT_BEND] * rate * rate;
    }
    /* sigma = -F/A + |M| R/I, tau = |S|/A + |T| R/J with I = A R^2/4, J = 2 I */
    const double lever = p[CONTACT_FAR], pulled = p[CONTACT_TENSILE] * (lever * contact__size(moment) - normal);
    const double sheared = p[CONTACT_SHEARED] * (contact__size(shear) + 0.5 * lever * fabs(torsion));
    const int held = was > 0.0 && pulled <= 1.0 && sheared <= 1.0, broke = was > 0.0 && !held;
    const double normal_power = lag * p[CONTACT_STRETCH] * c->closing * c->closing;
    const double undefined = 0.0 * p[CONTACT_STRETCH]; /* NaN if no bond was defined */
    r->normal = held ? normal + lag * p[CONTACT_STRETCH] * c->closing : r->normal + undefined;
    r->contact = held ? (was > 1.5 ? 0.0 : normal) : r->contact; /* a bond that begins is no impact */
    r->elastic = held ? elastic : r->elastic;
    r->normal_power = held ? normal_power : r->normal_power;
    r->slide_loss = held ? 0.0 : broke ? elastic : r->slide_loss;
    r->rolling_power = held ? lag * power : r->rolling_power;
    r->ended = held ? 0.0 : r->ended;
    for (int a = 0; a < 3; a++) {
        state[a] = held ? 0.0 : dry[a];
        state[CONTACT_WAY + a] = held ? way[a] : 0.0;
        state[CONTACT_BENT + a] = held ? bent[a] : 0.0;
        r->tangential[a] = held ? -shear[a] - lag * p[CONTACT_SHEAR] * c->slip[a] : r->tangential[a];
        r->rolling[a] = held ? rolling[a] : 0.0;
    }
    state[CONTACT_TURNED] = held ? turned : 0.0;
    state[CONTACT_WHOLE] = held ? 1.0 : 0.0;
    state[CONTACT_REST] = rest;
}

/* A beam of length R_i + R_j (wall: R_i) and round section between the centres. */
static inline double contact_prepare_bonds(const dem_birth *b, double *constants) {
    const contact_pair_def p = contact__pair_of(b);
    const int wall = !(b->radius_j > 0.0);
    const double radius = p.bond_radius * (wall || b->radius_i < b->radius_j ? b->radius_i : b->radius_j);
    const double area = RIDDLE_PI * radius * radius, second = 0.25 * area * radius * radius;
    const double per_area = p.bond_modulus / (b->radius_i + b->radius_j);
    constants[CONTACT_STRETCH] = per_area * area;
    constants[CONTACT_SHEAR] = p.bond_shear * per_area * area;
    constants[CONTACT_BEND] = per_area * second;
    constants[CONTACT_TORSION] = 2.0 * p.bond_shear * per_area * second;
    constants[CONTACT_LAG] = p.bond_modulus > 0.0 ? 2.0 * p.bond_damping * sqrt(b->mass / (per_area * area)) : 0.0;
    constants[CONTACT_TENSILE] = 1.0 / (p.tensile * area);
    constants[CONTACT_SHEARED] = 1.0 / (p.shear * area);
    constants[CONTACT_FAR] = 4.0 / radius;
    dem_prepare_linear(b, constants);
    return 0.0;
}
/* Whether the materials of a contact bond. */
static inline int contact__bonds(const dem_world *world, const dem_contact_info *c) {
    const int j = c->j >= 0 ? world->material[c->j] : world->wall[-1 - c->j].material;
    return contact_pair((contact_laws *)world->user, world->material[c->i], j)->bond_modulus > 0.0;
}
static inline void contact_bonds_born(dem_world *world, const int32_t *numbers, ptrdiff_t n, void *user) {
    const contact_laws *laws = (const contact_laws *)user;
    for (ptrdiff_t k = 0; laws && laws->bonding && k < n; k++) {
        dem_contact_info c = dem_get_contact(world, numbers[k]);
        if (!contact__bonds(world, &c)) continue;
        c.state[CONTACT_WHOLE] = 2.0;
        dem_set_contact_state(world, numbers[k], c.state);
    }
}
/* Is contact k (0 .. dem_contact_count-1) a whole bond? */
CONTACT_API int contact_is_bond(const dem_world *world, ptrdiff_t k);
/* Makes bonds of what touches now: of all contacts with an overlap that are none, where the pair has a bond_modulus;
   the gap of now is the rest length. world->user: a contact_laws. Between runs of contact_bonds (0 s finds the
   contacts). Returns the number of bonds made. */
CONTACT_API ptrdiff_t contact_bond_touching(dem_world *world);

static const dem_law contact_bonds = {"bonds",
                                      1,
                                      CONTACT_BOND_STATES,
                                      CONTACT_BOND_STATES,
                                      3,
                                      DEM_CONSTANTS_MAX,
                                      contact_prepare_bonds,
                                      contact_bond_force,
                                      contact_bonds_born,
                                      NULL};

#ifdef CONTACT__BODIES

/* ==================================================== >>bodies ==================================================== */

CONTACT_API contact_laws contact_default_laws(void) {
    contact_laws laws;
    memset(&laws, 0, sizeof laws);
    for (int a = 0; a < DEM_MATERIALS_MAX; a++) {
        for (int b = 0; b < DEM_MATERIALS_MAX; b++) {
            contact_pair_def *p = &laws.pair[a][b];
            p->rolling_damping = 0.3;
            p->bond_shear = 0.4;
            p->bond_radius = 1.0;
            p->bond_damping = 0.1;
            p->tensile = p->shear = HUGE_VAL;
        }
    }
    return laws;
}

CONTACT_API contact_pair_def *contact_pair(contact_laws *laws, int a, int b) {
    if (!laws || a < 0 || b < 0 || a >= DEM_MATERIALS_MAX || b >= DEM_MATERIALS_MAX) return NULL;
    return a < b ? &laws->pair[a][b] : &laws->pair[b][a];
}

CONTACT_API const char *contact_bad_field(const contact_laws *laws) {
    if (!laws) return "laws";
    for (int a = 0; a < DEM_MATERIALS_MAX; a++) {
        for (int b = a; b < DEM_MATERIALS_MAX; b++) {
            const contact_pair_def *p = &laws->pair[a][b];
            if (!(p->rolling >= 0.0 && p->rolling <= DBL_MAX)) return "rolling";
            if (!(p->rolling_damping >= 0.0 && p->rolling_damping <= DBL_MAX)) return "rolling_damping";
            if (!(p->twisting >= 0.0 && p->twisting <= DBL_MAX)) return "twisting";
            if (!(p->surface_energy >= 0.0 && p->surface_energy <= DBL_MAX)) return "surface_energy";
            if (!(p->bond_modulus >= 0.0 && p->bond_modulus <= DBL_MAX)) return "bond_modulus";
            if (!(p->bond_shear >= 0.0 && p->bond_shear <= DBL_MAX)) return "bond_shear";
            if (!(p->bond_radius > 0.0 && p->bond_radius <= DBL_MAX)) return "bond_radius";
            if (!(p->bond_damping >= 0.0 && p->bond_damping <= DBL_MAX)) return "bond_damping";
            if (!(p->tensile > 0.0)) return "tensile";
            if (!(p->shear > 0.0)) return "shear";
        }
    }
    return NULL;
}

CONTACT_API double contact_jkr_pull_off(double radius, double energy) {
    return radius > 0.0 && energy >= 0.0 ? 1.5 * RIDDLE_PI * energy * radius : (double)NAN;
}

CONTACT_API double contact_dmt_pull_off(double radius, double energy) {
    return radius > 0.0 && energy >= 0.0 ? 2.0 * RIDDLE_PI * energy * radius : (double)NAN;
}

CONTACT_API double contact_jkr_release(double radius, double modulus, double energy) {
    if (!(radius > 0.0 && modulus > 0.0 && energy >= 0.0)) return (double)NAN;
    return contact__jkr_least(radius * sqrt(2.0 * RIDDLE_PI * energy / modulus)) / radius;
}

CONTACT_API double contact_jkr_radius(double radius, double modulus, double energy, double overlap) {
    if (!(overlap >= contact_jkr_release(radius, modulus, energy))) return (double)NAN;
    const double s = contact__jkr_root(radius * sqrt(2.0 * RIDDLE_PI * energy / modulus), radius * overlap);
    return s * s;
}

CONTACT_API double contact_jkr_law(double radius, double modulus, double energy, double a) {
    if (!(radius > 0.0 && modulus > 0.0 && energy >= 0.0 && a >= 0.0)) return (double)NAN;
    return 4.0 / 3.0 * modulus * a * a * a / radius - sqrt(8.0 * RIDDLE_PI * energy * modulus * a) * a;
}

CONTACT_API double contact_jkr_work(double radius, double modulus, double energy) {
    if (!(radius > 0.0 && modulus > 0.0 && energy >= 0.0)) return (double)NAN;
    const double b = riddle_cbrt(2.0 * RIDDLE_PI * energy * radius * radius / modulus);
    return (0.3 + 0.2 / riddle_cbrt(256.0)) * modulus * b * b * b * b * b / (radius * radius);
}

CONTACT_API double contact_jkr_sticking_speed(double radius, double modulus, double energy, double mass) {
    return mass > 0.0 ? sqrt(2.0 * contact_jkr_work(radius, modulus, energy) / mass) : (double)NAN;
}

CONTACT_API int contact_is_bond(const dem_world *world, ptrdiff_t k) {
    return dem_get_contact(world, k).state[CONTACT_WHOLE] > 0.0;
}

CONTACT_API ptrdiff_t contact_bond_touching(dem_world *world) {
    ptrdiff_t made = 0;
    for (ptrdiff_t k = 0; world && world->user && k < dem_contact_count(world); k++) {
        dem_contact_info c = dem_get_contact(world, k);
        if (c.state[CONTACT_WHOLE] > 0.0 || !(c.gap < 0.0) || !contact__bonds(world, &c)) continue;
        c.state[CONTACT_WHOLE] = 2.0;
        dem_set_contact_state(world, k, c.state);
        made++;
    }
    return made;
}

#endif /* CONTACT__BODIES */

#ifdef __cplusplus
}
#endif
#endif
