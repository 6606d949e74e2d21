/* Spheres moved through one step of the fluid: weight, the fluid's force, contacts, lubrication. */
#pragma once
#include "../fluid/fluid.h"
#include "../solids/solids.h"
#include "../../base/portable_math.h"

/* ==== >>motion ==== */

FILTRATION_API double filtration_lubrication_force(double r1, double r2, double gap, double closing, double viscosity,
                                                   double cutoff, double least) {
    if (!(r1 > 0.0 && r2 > 0.0 && viscosity > 0.0 && cutoff > 0.0 && least > 0.0 && gap == gap && closing == closing))
        return (double)NAN;
    double r = r2 < HUGE_VAL ? r1 * r2 / (r1 + r2) : r1, h = gap > least ? gap : least;
    return h < cutoff ? 6.0 * RIDDLE_PI * viscosity * r * r * (1.0 / h - 1.0 / cutoff) * closing : 0.0;
}

FILTRATION_API filtration_motion_def filtration_motion_default_def(void) {
    filtration_motion_def def;
    memset(&def, 0, sizeof def);
    def.cookie = FILTRATION__COOKIE;
    def.density = 2200.0;
    def.gravity[2] = -9.81;
    def.modulus = 1e8;
    def.restitution = 0.5;
    def.friction = 0.3;
    def.sub_steps = 10;
    def.lubrication = 1;
    def.least_gap = 1e-3;
    def.spin = 1;
    return def;
}

static inline const char *filtration__bad_motion(const filtration_motion_def *d) {
    if (d->cookie != FILTRATION__COOKIE) return "cookie";
    if (!filtration__is_positive(d->density)) return "density";
    for (int a = 0; a < 3; a++) {
        if (!(fabs(d->gravity[a]) < HUGE_VAL)) return "gravity";
        if (d->fixed_axes[a] != 0 && d->fixed_axes[a] != 1) return "fixed_axes";
    }
    if (!filtration__is_positive(d->modulus)) return "modulus";
    if (!(d->restitution > 0.0 && d->restitution <= 1.0)) return "restitution";
    if (!(d->friction >= 0.0 && d->friction < HUGE_VAL)) return "friction";
    if (d->sub_steps < 1 || d->sub_steps > 1000000) return "sub_steps";
    if (d->lubrication != 0 && d->lubrication != 1) return "lubrication";
    if (!filtration__is_positive(d->least_gap)) return "least_gap";
    if (d->spin != 0 && d->spin != 1) return "spin";
    return NULL;
}

FILTRATION_API filtration_status filtration_motion_check_def(const filtration_motion_def *def, const char **field) {
    const char *bad = def ? filtration__bad_motion(def) : "def";
    if (field) *field = bad;
    return bad ? FILTRATION_BAD_DEF : FILTRATION_OK;
}

/* Returns the fraction of critical damping that gives a coefficient of restitution (Tsuji et al. 1992). */
static inline double filtration__damping(double restitution) {
    double log_e = riddle_log(restitution);
    return -log_e / sqrt(log_e * log_e + RIDDLE_PI * RIDDLE_PI);
}

FILTRATION_API double filtration_contact_sub_steps(const filtration_motion_def *def, double dt, double radius,
                                                   double speed) {
    if (!def || !(dt > 0.0 && radius > 0.0 && speed > 0.0)) return (double)NAN;
    double m = 0.5 * 4.0 / 3.0 * RIDDLE_PI * radius * radius * radius * def->density, r = 0.5 * radius;
    double time = 2.87 * riddle_pow(m * m / (r * def->modulus * def->modulus * speed),
                                    0.2); /* Hertz: E* in place of E/(1 - nu^2) */
    return time / (dt / def->sub_steps);
}

/* Two bodies in contact; the second may be a wall: of infinite radius, at rest. */
typedef struct filtration__touch {
    double gap, normal[3], r1, r2, mass; /* normal: from the first to the second; mass: reduced [kg] */
    double velocity[3];                  /* of the first's surface point relative to the second's [m/s] */
    double force[3];                     /* on the first [N] */
} filtration__touch;

/* Computes the force along the normal: Hertz with Tsuji's damping, which pulls at the end of a contact (a force clipped
   at 0 would need another damping for the same restitution). Returns it without lubrication, which is implicit in the
   closing velocity. */
static inline double filtration__touch_normal(const filtration_motion_def *def, const filtration_fluid *fluid, double h,
                                              double damping, double closing, filtration__touch *t) {
    double push = 0.0, film = 0.0;
    if (t->gap < 0.0) {
        const double r = t->r2 < HUGE_VAL ? t->r1 * t->r2 / (t->r1 + t->r2) : t->r1, root = sqrt(-r * t->gap);
        const double stiffness = 2.0 * def->modulus * root;
        push =
            -2.0 / 3.0 * stiffness * t->gap + 2.0 * 0.91287092917527686 * damping * sqrt(stiffness * t->mass) * closing;
    }
    if (def->lubrication) {
        const double least = def->least_gap * 2.0 * t->r1, cutoff = fluid->def.voxel * FILTRATION__FILM;
        const double rate =
            filtration_lubrication_force(t->r1, t->r2, t->gap, 1.0, fluid->def.viscosity, cutoff, least);
        film = rate * closing / (1.0 + rate * h / t->mass);
    }
    for (int a = 0; a < 3; a++) t->force[a] = -(push + film) * t->normal[a];
    return push;
}

/* Computes the force of a contact: along the normal, or the friction (Coulomb's, which at most stops sliding within a
   sub-step). Friction comes after all normal forces, so that it does not act on a velocity that another contact
   removes. Spheres can thus come to rest. */
static inline void filtration__touch_force(const filtration_motion_def *def, const filtration_fluid *fluid, double h,
                                           double damping, int friction, filtration__touch *t) {
    const double closing = filtration__dot(t->velocity, t->normal),
                 push = filtration__touch_normal(def, fluid, h, damping, closing, t);
    double slide = 0.0, tangential[3];
    if (!friction) return;
    for (int a = 0; a < 3; a++)
        tangential[a] = t->velocity[a] - closing * t->normal[a], slide += tangential[a] * tangential[a];
    slide = sqrt(slide);
    const double cap = t->mass * slide / ((def->spin ? 3.5 : 1.0) * h), most = def->friction * push;
    const double grip = most < cap ? most : cap;
    for (int a = 0; a < 3; a++) t->force[a] = slide > 0.0 && grip > 0.0 ? -grip / slide * tangential[a] : 0.0;
}

/* Computes the velocity of the surface of sphere n towards `normal`. */
static inline void filtration__rim_velocity(const filtration_spheres *s, ptrdiff_t n, const double normal[3],
                                            double sign, double u[3]) {
    const double *v = s->velocity + 3 * n, *w = s->spin + 3 * n;
    double r = sign * s->radius[n];
    u[0] = v[0] + r * (w[1] * normal[2] - w[2] * normal[1]);
    u[1] = v[1] + r * (w[2] * normal[0] - w[0] * normal[2]);
    u[2] = v[2] + r * (w[0] * normal[1] - w[1] * normal[0]);
}

static inline double filtration__sphere_mass(const filtration_motion_def *def, double r) {
    return 4.0 / 3.0 * RIDDLE_PI * r * r * r * def->density;
}

/* Kicks sphere n by a force at its surface point towards `normal`. */
static inline void filtration__kick(const filtration_motion_def *def, filtration_spheres *s, ptrdiff_t n,
                                    const double normal[3], double sign, const double force[3], double h,
                                    double *contact) {
    double m = filtration__sphere_mass(def, s->radius[n]), turn = h * sign / (0.4 * m * s->radius[n]);
    for (int a = 0; a < 3; a++) {
        if (!def->fixed_axes[a]) s->velocity[3 * n + a] += force[a] * h / m;
        if (contact) contact[3 * n + a] += force[a] / def->sub_steps;
        if (def->spin)
            s->spin[3 * n + a] +=
                turn * (normal[(a + 1) % 3] * force[(a + 2) % 3] - normal[(a + 2) % 3] * force[(a + 1) % 3]);
    }
}

/* Applies the contact of sphere n with sphere k, or with a wall (k < 0) whose gap and normal are in t. */
static inline void filtration__collide_pair(const filtration_motion_def *def, const filtration_fluid *fluid,
                                            filtration_spheres *s, ptrdiff_t n, ptrdiff_t k, double h, double damping,
                                            int friction, filtration__touch *t, double *contact) {
    double u[3] = {0, 0, 0}, back[3];
    double m1 = filtration__sphere_mass(def, s->radius[n]),
           m2 = k >= 0 ? filtration__sphere_mass(def, s->radius[k]) : 0.0;
    t->r1 = s->radius[n], t->r2 = k >= 0 ? s->radius[k] : HUGE_VAL, t->mass = k >= 0 ? m1 * m2 / (m1 + m2) : m1;
    filtration__rim_velocity(s, n, t->normal, 1.0, t->velocity);
    if (k >= 0) filtration__rim_velocity(s, k, t->normal, -1.0, u);
    for (int a = 0; a < 3; a++) t->velocity[a] -= u[a];
    filtration__touch_force(def, fluid, h, damping, friction, t);
    filtration__kick(def, s, n, t->normal, 1.0, t->force, h, contact);
    for (int a = 0; a < 3; a++) back[a] = -t->force[a];
    if (k >= 0) filtration__kick(def, s, k, t->normal, -1.0, back, h, contact);
}

#define FILTRATION__TOUCHES 32 /* most places at which a sphere touches the solid */

/* Finds the nearest place of a solid by differences of its distance. Returns their number, 0 or 1. */
static inline int filtration__touch_nearest(const filtration_solid *solid, const double centre[3], double radius,
                                            double reach, double step, filtration_near *near) {
    double length = 0.0;
    near->gap = solid->distance(solid->self, centre) - radius;
    if (!(near->gap < reach)) return 0;
    for (int a = 0; a < 3; a++) {
        double q[3] = {centre[0], centre[1], centre[2]};
        q[a] = centre[a] + step;
        near->normal[a] = -solid->distance(solid->self, q);
        q[a] = centre[a] - step;
        near->normal[a] += solid->distance(solid->self, q);
        length += near->normal[a] * near->normal[a];
    }
    length = sqrt(length);
    for (int a = 0; a < 3 && length > 0.0; a++) near->normal[a] /= length;
    return length > 0.0;
}

static inline int filtration__touch_solid(const filtration_fluid *fluid, const double centre[3], double radius,
                                          double reach, filtration_near *near) {
    const filtration_solid *solid = &fluid->def.solid;
    double box[3], p[3];
    for (int a = 0; a < 3; a++) {
        box[a] = fluid->def.nodes[a] * fluid->def.voxel;
        p[a] = filtration__repeats(fluid->lattice, a) ? centre[a] - box[a] * floor(centre[a] / box[a]) : centre[a];
    }
    if (!solid->touch) return filtration__touch_nearest(solid, p, radius, reach, 0.02 * fluid->def.voxel, near);
    const int n = solid->touch(solid->self, p, radius, reach, FILTRATION__TOUCHES, near);
    return n < 0 ? 0 : n < FILTRATION__TOUCHES ? n : FILTRATION__TOUCHES;
}

static inline void filtration__touch_walls(const filtration_motion_def *def, const filtration_fluid *fluid,
                                           filtration_spheres *s, ptrdiff_t n, double h, double damping, double reach,
                                           int friction, double *contact) {
    filtration__touch t;
    const double *x = s->centre + 3 * n;
    filtration_near near[FILTRATION__TOUCHES];
    const int places = fluid->def.solid.distance ? filtration__touch_solid(fluid, x, s->radius[n], reach, near) : 0;
    for (int k = 0; k < places; k++) {
        t.gap = near[k].gap;
        memcpy(t.normal, near[k].normal, sizeof t.normal);
        filtration__collide_pair(def, fluid, s, n, -1, h, damping, friction, &t, contact);
    }
    for (int f = 0; f < 6; f++) {
        if (!fluid->lattice->face[f]->is_touched) continue;
        int a = f / 2, high = f & 1;
        t.gap = (high ? fluid->def.nodes[a] * fluid->def.voxel - x[a] : x[a]) - s->radius[n];
        if (!(t.gap < reach)) continue;
        t.normal[0] = t.normal[1] = t.normal[2] = 0.0;
        t.normal[a] = high ? 1.0 : -1.0;
        filtration__collide_pair(def, fluid, s, n, -1, h, damping, friction, &t, contact);
    }
}

static inline void filtration__touch_pairs(const filtration_motion_def *def, const filtration_fluid *fluid,
                                           filtration_spheres *s, ptrdiff_t n, double h, double damping, double reach,
                                           int friction, double *contact) {
    for (ptrdiff_t k = n + 1; k < s->n; k++) {
        filtration__touch t;
        double dd = 0.0, sum = s->radius[n] + s->radius[k];
        if (!(s->radius[k] > 0.0)) continue;
        for (int a = 0; a < 3; a++) {
            double d = s->centre[3 * k + a] - s->centre[3 * n + a], box = fluid->def.nodes[a] * fluid->def.voxel;
            if (filtration__repeats(fluid->lattice, a)) d -= box * floor(d / box + 0.5);
            t.normal[a] = d;
            dd += d * d;
        }
        if (!(dd < (sum + reach) * (sum + reach)) || !(dd > 0.0)) continue;
        double distance = sqrt(dd);
        for (int a = 0; a < 3; a++) t.normal[a] /= distance;
        t.gap = distance - sum;
        filtration__collide_pair(def, fluid, s, n, k, h, damping, friction, &t, contact);
    }
}

/* Applies weight less buoyancy and the fluid's force and torque for a time h. */
static inline void filtration__push(const filtration_motion_def *def, const filtration_fluid *fluid,
                                    filtration_spheres *s, ptrdiff_t n, double share, double h) {
    double r = s->radius[n], m = filtration__sphere_mass(def, r), light = 1.0 - fluid->def.density / def->density;
    for (int a = 0; a < 3; a++) {
        if (!def->fixed_axes[a])
            s->velocity[3 * n + a] += h * (light * def->gravity[a] + share * s->force[3 * n + a] / m);
        if (def->spin) s->spin[3 * n + a] += h * share * s->torque[3 * n + a] / (0.4 * m * r * r);
    }
}

/* Returns whether the numbers of sphere n are in range, and also the speed that weight, fluid and films give it. */
static inline int filtration__can_move(const filtration_motion_def *def, const filtration_fluid *fluid,
                                       const filtration_spheres *s, ptrdiff_t n, double share) {
    const double r = s->radius[n], m = filtration__sphere_mass(def, r), light = 1.0 - fluid->def.density / def->density;
    const double film = filtration_lubrication_force(r, HUGE_VAL, 0.0, 1.0, fluid->def.viscosity,
                                                     fluid->def.voxel * FILTRATION__FILM, def->least_gap * 2.0 * r);
    if (r == 0.0) return 1;
    if (!(r > 0.0 && m > 1e-100 && m < 1e100) || (def->lubrication && !filtration__is_finite(film * fluid->dt / m)))
        return 0;
    for (int a = 0; a < 3; a++) {
        const double pushed =
            s->velocity[3 * n + a] + fluid->dt * (light * def->gravity[a] + share * s->force[3 * n + a] / m);
        const double turned = s->spin[3 * n + a] + fluid->dt * share * s->torque[3 * n + a] / (0.4 * m * r * r);
        if (!(fabs(s->centre[3 * n + a]) < 1e100 && fabs(pushed) < 1e100 && fabs(turned * r) < 1e100))
            return 0; /* squares are finite */
    }
    return 1;
}

/* Returns whether a contact left the numbers of sphere n finite. */
static inline int filtration__has_moved(const filtration_spheres *s, ptrdiff_t n, const double *contact) {
    double sum = 0.0;
    for (ptrdiff_t k = 3 * n; k < 3 * n + 3; k++)
        sum += 0.0 * s->centre[k] + 0.0 * s->velocity[k] + 0.0 * s->spin[k] + (contact ? 0.0 * contact[k] : 0.0);
    return sum == 0.0;
}

FILTRATION_API filtration_status filtration_move(const filtration_motion_def *def, const filtration_fluid *fluid,
                                                 filtration_spheres *spheres, double share, double *contact) {
    if (filtration_motion_check_def(def, NULL) != FILTRATION_OK) return FILTRATION_BAD_DEF;
    if (!fluid || !fluid->lattice || !spheres || spheres->n < 0 || !(share > 0.0 && share < HUGE_VAL))
        return FILTRATION_BAD_ARGUMENT;
    if (spheres->n > 0 && !(spheres->centre && spheres->velocity && spheres->spin && spheres->radius &&
                            spheres->force && spheres->torque))
        return FILTRATION_BAD_ARGUMENT;
    if (!(def->density >= 0.4 * fluid->def.density)) return FILTRATION_BAD_ARGUMENT;
    for (ptrdiff_t n = 0; n < spheres->n; n++)
        if (!filtration__can_move(def, fluid, spheres, n, share)) return FILTRATION_BAD_ARGUMENT;
    double h = fluid->dt / def->sub_steps, damping = filtration__damping(def->restitution);
    double reach = def->lubrication ? fluid->def.voxel * FILTRATION__FILM : 0.0;
    for (ptrdiff_t k = 0; contact && k < 3 * spheres->n; k++) contact[k] = 0.0;
    for (int sub = 0; sub < def->sub_steps; sub++) {
        for (ptrdiff_t n = 0; n < spheres->n; n++) {
            if (!(spheres->radius[n] > 0.0)) continue;
            filtration__push(def, fluid, spheres, n, share, h);
        }
        for (int friction = 0; friction < (def->friction > 0.0 ? 2 : 1); friction++)
            for (ptrdiff_t n = 0; n < spheres->n; n++) {
                if (!(spheres->radius[n] > 0.0)) continue;
                const double near = friction ? 0.0 : reach;
                filtration__touch_walls(def, fluid, spheres, n, h, damping, near, friction, contact);
                filtration__touch_pairs(def, fluid, spheres, n, h, damping, near, friction, contact);
            }
        for (ptrdiff_t n = 0; n < spheres->n; n++)
            for (int a = 0; a < 3; a++)
                if (spheres->radius[n] > 0.0 && !def->fixed_axes[a])
                    spheres->centre[3 * n + a] += h * spheres->velocity[3 * n + a];
        for (ptrdiff_t n = 0; n < spheres->n; n++)
            if (spheres->radius[n] > 0.0 && !filtration__has_moved(spheres, n, contact)) return FILTRATION_TOO_FAST;
    }
    return FILTRATION_OK;
}
