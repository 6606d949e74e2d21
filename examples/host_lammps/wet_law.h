/* wet_law.h - the forces between two wet bodies, for a host that has its own particles: composed of dem.h's linear
   contact law and liquid_bridge.h's bridges. Nothing here knows a host. A host calls three functions:

       wet_form    when two bodies touch that no bridge joins: makes the bridge from the liquid that each gives
       wet_force   in every step in which they touch or a bridge joins them: force and torques, and 1 at rupture
       wet_split   at rupture: how much of the liquid goes to i

   and keeps `wet_state` with the pair: 16 doubles. */
#ifndef RIDDLE_WET_LAW_H
#define RIDDLE_WET_LAW_H

#include <string.h>

#include "dem.h"
#include "liquid_bridge.h"

/* One kind of pair: contact parameters and the prepared bridge. */
typedef struct wet_kind {
    dem_pair_def contact; /* stiffness, restitution, friction ...; mode DEM_NAIVE or DEM_CLIPPED */
    double damping_ratio; /* dem_damping_ratio of the coefficient of restitution [-] */
    bridge_pair bridge;   /* its def's i is the kind's first class */
} wet_kind;

/* What a pair remembers. */
typedef struct wet_state {
    double slip[3]; /* tangential displacement of i against j since the contact began [m] */
    double asked;   /* 1 while the bodies touch and have asked for liquid, else 0 */
    bridge liquid;  /* liquid.volume = 0: dry */
} wet_state;
enum { WET_STATE_SIZE = sizeof(wet_state) / sizeof(double) };

/* Two bodies near each other; n points from j to i. A wall has arm_j = 0 and an infinite mass. */
typedef struct wet_encounter {
    double gap, normal[3];       /* surface distance [m]; n */
    double velocity[3];          /* of i's centre against j's centre, or against a wall's surface [m/s] */
    double spin_i[3], spin_j[3]; /* [rad/s] */
    double radius_i, radius_j;   /* [m]; radius_j INFINITY for a wall */
    double arm_i, arm_j;         /* from the centres to the point of contact [m] */
    double mass_i, mass_j;       /* [kg]; mass_j INFINITY for a wall */
    double dt;                   /* by which the friction history advances [s]; 0: not at all */
} wet_encounter;

typedef struct wet_answer {
    double force[3];                 /* on i [N]; the opposite acts on j */
    double torque_i[3], torque_j[3]; /* [N m] */
    int touching, ruptured;
} wet_answer;

static inline double wet_dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
static inline void wet_cross(const double *a, const double *b, double *c) {
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Prepares a kind from its contact parameters and the definition of its bridge. */
static inline bridge_status wet_prepare(wet_kind *kind, const dem_pair_def *contact, const bridge_pair_def *def) {
    kind->contact = *contact;
    kind->damping_ratio = dem_damping_ratio(contact->restitution, contact->mode);
    return bridge_pair_prepare(&kind->bridge, def);
}

/* What of a film [m3] a body offers a new bridge; the answer is capped to what the bridge may hold. */
static inline void wet_offer(const wet_kind *kind, double film_i, double film_j, double radius_i, double radius_j,
                             double quantum, double *offer_i, double *offer_j) {
    double smallest, largest;
    const int wall = !(radius_j < (double)HUGE_VAL);
    *offer_i = wall ? bridge_share_wall(film_i) : bridge_share_sphere(film_i, radius_i, radius_j);
    *offer_j = wall ? 0.0 : bridge_share_sphere(film_j, radius_j, radius_i);
    bridge_volume_range(&kind->bridge, radius_i, radius_j, &smallest, &largest);
    const double volume = *offer_i + *offer_j, cap = volume > largest ? largest / volume : 1.0;
    *offer_i = bridge_quantised(*offer_i * cap, quantum);
    *offer_j = bridge_quantised(*offer_j * cap, quantum);
}

/* Forms the bridge of what i and j give [m3], multiples of the quantum. Returns 1; or 0, takes nothing, if it is too
   little. swapped: i is of the kind's second class. */
static inline int wet_form(const wet_kind *kind, double radius_i, double radius_j, double given_i, double given_j,
                           int swapped, wet_state *state) {
    return bridge_form(&kind->bridge, radius_i, radius_j, given_i, given_j, swapped, &state->liquid) == BRIDGE_OK;
}

/* What of the bridge's liquid goes to i at rupture [m3]; the rest is j's. Both together are exactly the
   bridge's volume. */
static inline double wet_split(const wet_state *state, double quantum) {
    return bridge_split_volume(&state->liquid, quantum);
}

/* Turns the stored slip into the tangential plane; its length stays. */
static inline void wet_turn_slip(double *slip, const double *normal) {
    const double along = wet_dot(slip, normal), before = wet_dot(slip, slip);
    for (int a = 0; a < 3; a++) slip[a] -= along * normal[a];
    const double after = wet_dot(slip, slip), scale = after > 0.0 ? sqrt(before / after) : 0.0;
    for (int a = 0; a < 3; a++) slip[a] *= scale;
}

/* Adds the dry contact force of dem.h's linear law to the tangential and normal parts. */
static inline void wet_dry_contact(const wet_kind *kind, const wet_encounter *e, const dem_contact *geometry,
                                   double *slip, double *normal, double *tangential) {
    double constants[DEM_LINEAR_CONSTANTS];
    dem_birth birth;
    dem_response r;
    dem_contact c = *geometry;
    memset(&birth, 0, sizeof birth);
    memset(&r, 0, sizeof r);
    birth.features = DEM_LINEAR | DEM_FRICTION;
    birth.pair = &kind->contact;
    birth.radius_i = e->radius_i;
    birth.mass = c.mass;
    birth.damping_ratio = kind->damping_ratio;
    dem_prepare_linear(&birth, constants);
    c.constants = constants;
    wet_turn_slip(slip, e->normal);
    dem_force_linear_friction(&c, slip, &r);
    *normal += r.normal;
    for (int a = 0; a < 3; a++) tangential[a] += r.tangential[a];
}

static inline void wet_force(const wet_kind *kind, const bridge_liquid *liquid, const wet_encounter *e,
                             wet_state *state, wet_answer *answer) {
    dem_contact c;
    double lever[3], turn[3], normal = 0.0, tangential[3] = {0.0, 0.0, 0.0}, moment[3];
    const double opening = wet_dot(e->velocity, e->normal);
    memset(&c, 0, sizeof c);
    for (int a = 0; a < 3; a++) {
        c.normal[a] = e->normal[a];
        c.translation[a] = e->velocity[a] - opening * e->normal[a];
        lever[a] = e->arm_i * e->spin_i[a] + e->arm_j * e->spin_j[a];
    }
    wet_cross(e->normal, lever, turn);
    for (int a = 0; a < 3; a++) c.slip[a] = c.translation[a] + turn[a];
    c.gap = e->gap;
    c.closing = -opening;
    c.dt = e->dt;
    c.mass = e->mass_j < (double)HUGE_VAL ? e->mass_i * e->mass_j / (e->mass_i + e->mass_j) : e->mass_i;

    answer->touching = e->gap < 0.0;
    answer->ruptured = 0;
    if (answer->touching) wet_dry_contact(kind, e, &c, state->slip, &normal, tangential);
    else state->slip[0] = state->slip[1] = state->slip[2] = 0.0;
    if (state->liquid.volume > 0.0) {
        const bridge_forces f = bridge_evaluate(&state->liquid, liquid, e->gap, opening);
        normal -= f.normal;
        for (int a = 0; a < 3; a++) tangential[a] -= f.tangential * c.translation[a] + f.spin * turn[a];
        answer->ruptured = bridge_is_ruptured(&state->liquid, liquid, e->gap, opening);
    }
    wet_cross(e->normal, tangential, moment);
    for (int a = 0; a < 3; a++) {
        answer->force[a] = normal * e->normal[a] + tangential[a];
        answer->torque_i[a] = -e->arm_i * moment[a];
        answer->torque_j[a] = -e->arm_j * moment[a];
    }
}

#endif
