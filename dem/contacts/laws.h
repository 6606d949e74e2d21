/* The shipped laws of contact: pure functions of one contact's scalars and its history. */
#pragma once
#include "../base/law.h"
#include "../../base/portable_math.h"

/* Linear spring-dashpot (Elskamp & Kruggel-Emden 2019, eqs 4 and 5). Constants: */
enum {
    DEM__K,       /* k_n [N/m] */
    DEM__GAMMA,   /* dashpot [kg/s] */
    DEM__FLOOR,   /* least force: 0 clipped, -inf naive [N] */
    DEM__KT,      /* k_t [N/m] */
    DEM__MU,      /* Coulomb coefficient [-] */
    DEM__GAMMA_T, /* tangential dashpot [kg/s] */
    DEM__ROLL,    /* lever arm [m] */
    DEM__ROLL_CAP /* I_red/2 [kg m2]: a larger torque would reverse the spin within a step */
};
/* State, from DEM__XI on: tangential displacement [m], which the kernel turns with the contact. */
enum { DEM__XI };

/* Returns the factor of the dashpot's velocity, which is predicted over a step h. With it, an oscillation of two bodies
   with a linear spring of k m/h^2 and a dashpot of c m/h decays correctly to third order. It follows from the
   characteristic equation of the scheme for positions proportional to z^n: 2 z (z - 1)^2 + 2 k z^2 + c (z - 1)(3 z - 1)
   = 0. */
DEM_INLINE double dem__prediction(double k, double c) {
    return 1.0 - (11.0 * k - 5.0 * c * c + 9.0 * c * k - 3.0 * c * c * c) / 24.0;
}

/* Computes rolling resistance against the relative spin: at most the torque that stops the spin in two steps. */
DEM_INLINE void dem__roll(const dem_contact *c, double normal, double arm, double cap, dem_response *r) {
    const double *n = c->normal, *w = c->spin;
    double along = w[0] * n[0] + w[1] * n[1] + w[2] * n[2];
    double x = w[0] - along * n[0], y = w[1] - along * n[1], z = w[2] - along * n[2];
    double speed = sqrt(x * x + y * y + z * z) + 1e-300;
    double torque = arm * normal / speed, most = cap * c->share * c->rate;
    torque = torque < most ? torque : most;
    r->rolling[0] = -torque * x;
    r->rolling[1] = -torque * y;
    r->rolling[2] = -torque * z;
    r->rolling_power += torque * speed * speed;
}

/* Computes forces, energies and history of a linear contact. features: a constant at compile time. */
DEM_INLINE void dem__linear(const dem_contact *c, double *state, dem_response *r, int features) {
    const double *p = c->constants;
    double spring = -p[DEM__K] * c->gap, force = spring + p[DEM__GAMMA] * c->closing;
    force = force > p[DEM__FLOOR] ? force : p[DEM__FLOOR];
    force = c->gap < 0.0 ? force : 0.0;
    r->normal = r->contact = force;
    r->ended = c->gap < 0.0 ? 0.0 : 1.0;
    r->elastic = c->gap < 0.0 ? 0.5 * spring * -c->gap : 0.0;
    r->normal_power = c->gap < 0.0 ? (force - spring) * c->closing : 0.0;
    r->slide_loss = 0.0;
    r->rolling_power = 0.0;
    if (!(features & DEM_FRICTION)) return;

    double push = force > 0.0 ? force : 0.0, limit = p[DEM__MU] * push;
    double relax = p[DEM__GAMMA_T] / (p[DEM__KT] > 0.0 ? p[DEM__KT] : 1.0), xi[3],
           t[3]; /* [s]; any value if there is no spring */
    for (int a = 0; a < 3; a++) {
        xi[a] = state[DEM__XI + a] + c->slip[a] * c->dt;
        t[a] = p[DEM__KT] * xi[a] + p[DEM__GAMMA_T] * c->slip[a];
    }
    double size = sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]), most = size + 1e-300;
    double scale =
        (limit < most ? limit : most) / most; /* with 1 here gcc would compute both cases below */
    for (int a = 0; a < 3; a++) {
        double kept = size > limit ? scale * (xi[a] + relax * c->slip[a])
                                   : xi[a]; /* when it slides, the spring carries the whole force */
        r->slide_loss += 0.5 * p[DEM__KT] * (state[DEM__XI + a] + kept) * (xi[a] - kept); /* work of the mean force over
                                                                                             the distance slid */
        r->elastic += 0.5 * p[DEM__KT] * kept * kept;
        r->rolling_power += (scale * t[a] - p[DEM__KT] * kept) * c->slip[a];
        state[DEM__XI + a] = kept;
        r->tangential[a] = -scale * t[a];
    }
    if (features & DEM_ROLLING) dem__roll(c, push, p[DEM__ROLL], p[DEM__ROLL_CAP], r);
}

static inline double dem_prepare_linear(const dem_birth *b, double *constants) {
    const dem_pair_def *pair = b->pair;
    double k = pair->stiffness;
    double gamma = 2.0 * b->damping_ratio * sqrt(k * b->mass);
    constants[DEM__K] = k;
    constants[DEM__GAMMA] = gamma;
    constants[DEM__FLOOR] = pair->mode == DEM_CLIPPED ? 0.0 : -HUGE_VAL;
    constants[DEM__KT] = k * pair->tangential_ratio;
    constants[DEM__MU] = b->features & DEM_FRICTION ? pair->friction : 0.0;
    constants[DEM__GAMMA_T] = gamma * pair->tangential_damping;
    constants[DEM__ROLL] = b->features & DEM_ROLLING ? pair->rolling : 0.0;
    constants[DEM__ROLL_CAP] = 0.5 * b->inertia;
    return k;
}

/* Hertz-Mindlin. Normal force 4/3 E* sqrt(R*) delta^1.5; dashpot sqrt(5) beta sqrt(m k) delta^0.25 (Tsuji et al. 1992;
   gives e exactly: Antypov & Elliott 2011); tangential force 8 G* sqrt(R* delta) times the displacement (Mindlin 1949,
   without microslip). A stored tangential force follows the contact radius when it grows and when it shrinks, as in
   Chung & Ooi's impact tests and in the common codes. The energy that a change of the radius adds or takes counts as
   sliding loss, with its sign. */
enum {
    DEM__HERTZ_K,
    DEM__HERTZ_GAMMA,
    DEM__HERTZ_RADIUS,
    DEM__HERTZ_G,
    DEM__HERTZ_MU,
    DEM__HERTZ_GAMMA_T,
    DEM__HERTZ_ROLL,
    DEM__HERTZ_CAP
};
enum { DEM__FT, DEM__AREA = 3 }; /* tangential force [N], contact radius [m] */

/* Computes forces, energies and history of a Hertz contact. features: a constant at compile time. */
DEM_INLINE void dem__hertz(const dem_contact *c, double *state, dem_response *r, int features) {
    const double *p = c->constants;
    double overlap = c->gap < 0.0 ? -c->gap : 0.0, area = sqrt(p[DEM__HERTZ_RADIUS] * overlap);
    double spring = p[DEM__HERTZ_K] * area * overlap, damping = p[DEM__HERTZ_GAMMA] * sqrt(area);
    double step = c->dt / c->mass,
           k = 1.5 * p[DEM__HERTZ_K] * area * c->dt * step; /* of a spring that is as stiff as the contact now */
    double closing = dem__prediction(k, damping * step) * c->closing, force = spring + damping * closing;
    r->normal = r->contact = force;
    r->ended = c->gap < 0.0 ? 0.0 : 1.0;
    r->elastic = 0.4 * spring * overlap;
    r->normal_power = (1.0 - k / 24.0) * damping * closing * c->closing; /* see the kernel */
    r->slide_loss = 0.0;
    r->rolling_power = 0.0;
    if (!(features & DEM_FRICTION)) return;

    double push = force > 0.0 ? force : 0.0, limit = p[DEM__HERTZ_MU] * push;
    double kt = p[DEM__HERTZ_G] * area, before = state[DEM__AREA];
    double follow = area / (before + 1e-300); /* in a new contact the force is zero */
    double t[3], f[3], old = 0.0, work = 0.0, now = 0.0;
    for (int a = 0; a < 3; a++) {
        old += state[DEM__FT + a] * state[DEM__FT + a];
        f[a] = follow * state[DEM__FT + a] + kt * c->slip[a] * c->dt;
        t[a] = f[a] + damping * p[DEM__HERTZ_GAMMA_T] * c->slip[a];
    }
    double size = sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]), most = size + 1e-300;
    double scale = (limit < most ? limit : most) / most; /* as above */
    for (int a = 0; a < 3; a++) {
        double kept = size > limit ? scale * t[a] : f[a];
        work += 0.5 * (state[DEM__FT + a] + kept) * c->slip[a] * c->dt;
        now += kept * kept;
        r->rolling_power += (scale * t[a] - kept) * c->slip[a];
        state[DEM__FT + a] = kept;
        r->tangential[a] = -scale * t[a];
    }
    double stored = 0.5 * now / (kt + 1e-300);
    r->slide_loss = 0.5 * old / (p[DEM__HERTZ_G] * before + 1e-300) + work - stored;
    r->elastic += stored;
    state[DEM__AREA] = area;
    if (features & DEM_ROLLING) dem__roll(c, push, p[DEM__HERTZ_ROLL], p[DEM__HERTZ_CAP], r);
}

/* Computes the constants of a contact by Hertz. Shear modulus of the pair: 1/G* = (2 - nu_i)/G_i + (2 - nu_j)/G_j with
   G = E/(2 (1 + nu)). */
static inline double dem_prepare_hertz(const dem_birth *b, double *constants) {
    const dem_material *i = &b->def->material[b->material_i], *j = &b->def->material[b->material_j];
    double modulus = 1.0 / ((1.0 - i->poisson_ratio * i->poisson_ratio) / i->young_modulus +
                            (1.0 - j->poisson_ratio * j->poisson_ratio) / j->young_modulus);
    double shear = 0.5 / ((2.0 - i->poisson_ratio) * (1.0 + i->poisson_ratio) / i->young_modulus +
                          (2.0 - j->poisson_ratio) * (1.0 + j->poisson_ratio) / j->young_modulus);
    double inverse = 1.0 / b->radius_i + (b->radius_j > 0.0 ? 1.0 / b->radius_j : b->curvature);
    double log_e = riddle_log(b->pair->restitution), beta = -log_e / sqrt(log_e * log_e + RIDDLE_PI * RIDDLE_PI);
    constants[DEM__HERTZ_K] = 4.0 / 3.0 * modulus;
    constants[DEM__HERTZ_GAMMA] = sqrt(5.0) * beta * sqrt(4.0 / 3.0 * modulus * b->mass);
    constants[DEM__HERTZ_RADIUS] = 1.0 / inverse;
    constants[DEM__HERTZ_G] = 8.0 * shear;
    constants[DEM__HERTZ_MU] = b->features & DEM_FRICTION ? b->pair->friction : 0.0;
    constants[DEM__HERTZ_GAMMA_T] = b->pair->tangential_damping;
    constants[DEM__HERTZ_ROLL] = b->features & DEM_ROLLING ? b->pair->rolling : 0.0;
    constants[DEM__HERTZ_CAP] = 0.5 * b->inertia;
    return 0.0;
}

#define DEM__FORCE(name, body, features)                                                                               \
    DEM_INLINE void name(const dem_contact *c, double *state, dem_response *r) { body(c, state, r, features); }
DEM__FORCE(dem_force_linear, dem__linear, DEM_LINEAR)
DEM__FORCE(dem_force_linear_friction, dem__linear, DEM_FRICTION)
DEM__FORCE(dem_force_linear_rolling, dem__linear, DEM_FRICTION | DEM_ROLLING)
DEM__FORCE(dem_force_hertz, dem__hertz, DEM_HERTZ)
DEM__FORCE(dem_force_hertz_friction, dem__hertz, DEM_FRICTION)
DEM__FORCE(dem_force_hertz_rolling, dem__hertz, DEM_FRICTION | DEM_ROLLING)
