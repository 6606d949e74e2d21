/* Damping ratio, restitution, duration of a contact, advice on the time step. */
#pragma once
#include "stiffness.h"
#include "laws.h"
#include "../motion/motion.h"
#include "../walls/kind.h"

/* Returns half the duration of a clipped contact times omega_0 (Schwager & Poeschel 2007), in one form for any damping.
 */
DEM_INLINE double dem__half_duration(double zeta) {
    double d = zeta - 1.0;
    if (fabs(d) < 1e-3) return 1.0 - d * (1.0 / 3.0 - d * (2.0 / 15.0 - d * (2.0 / 35.0 - d * 8.0 / 315.0)));
    if (zeta < 1.0) return riddle_acos(zeta) / sqrt((1.0 - zeta) * (1.0 + zeta));
    double root = sqrt(zeta - 1.0) * sqrt(zeta + 1.0);
    return riddle_log(zeta + root) / root;
}

DEM_API double dem_restitution_of(double zeta, dem_restitution mode) {
    if (!(zeta >= 0.0 && zeta <= DBL_MAX)) return (double)NAN;
    if (mode == DEM_CLIPPED) return riddle_exp(-2.0 * zeta * dem__half_duration(zeta));
    return zeta < 1.0 ? riddle_exp(-RIDDLE_PI * zeta / sqrt((1.0 - zeta) * (1.0 + zeta))) : (double)NAN;
}

DEM_API double dem_damping_ratio(double e, dem_restitution mode) {
    if (!(e > 0.0 && e <= 1.0)) return (double)NAN;
    double log_e = riddle_log(e), zeta = -log_e / sqrt(RIDDLE_PI * RIDDLE_PI + log_e * log_e);
    if (mode == DEM_NAIVE || e == 1.0) return e == 1.0 ? 0.0 : zeta;
    if (e < 0.02) zeta = 1.0 / (2.0 * sqrt(e)); /* e -> 1/(4 zeta^2) */
    for (int k = 0; k < 60; k++) {
        double g = dem__half_duration(zeta), d = zeta - 1.0;
        double slope = fabs(d) < 1e-3 ? 2.0 / 3.0 - d * 4.0 / 15.0 * 0.5 : (g - zeta) / ((1.0 - zeta) * (1.0 + zeta));
        double next = zeta - (log_e + 2.0 * zeta * g) / (2.0 * slope);
        next = next > 0.0 ? next : 0.5 * zeta;
        double change = fabs(next - zeta);
        zeta = next;
        if (!(change > 2e-16 * zeta)) break;
    }
    return zeta;
}

DEM_API double dem_contact_time(double k, double mass, double zeta, dem_restitution mode) {
    if (!(k > 0.0 && mass > 0.0 && zeta >= 0.0) || !(zeta <= DBL_MAX) || (mode == DEM_NAIVE && !(zeta < 1.0)))
        return (double)NAN;
    double period = sqrt(mass / k);
    return mode == DEM_CLIPPED ? 2.0 * dem__half_duration(zeta) * period
                               : RIDDLE_PI * period / sqrt((1.0 - zeta) * (1.0 + zeta));
}

DEM_API double dem_hertz_contact_time(double modulus, double radius, double mass, double speed) {
    if (!(modulus > 0.0 && radius > 0.0 && mass > 0.0 && speed > 0.0)) return (double)NAN;
    double k = 16.0 / 15.0 * modulus * sqrt(radius); /* energy 2/5 * 4/3 E* sqrt(R) delta^2.5 = m v^2/2 */
    double overlap = riddle_exp(0.4 * riddle_log(mass * speed * speed / k));
    return 2.943275175395 * overlap / speed; /* 2 sqrt(pi) Gamma(7/5)/Gamma(9/10) */
}

/* What is present of a material: the least radius of its free and of its fixed particles, the least effective mass of a
   body in its contacts, and the highest rate of these. */
typedef struct dem__present {
    double smallest, fixed, lightest; /* [m], [m], [kg]; infinite if there is none */
    double rate;                      /* over k/m; 1 for spheres */
    int is_wall;
} dem__present;
static inline void dem__list_present(const dem_world *w, dem__present *of) {
    for (int m = 0; m < DEM_MATERIALS_MAX; m++) {
        of[m].smallest = of[m].fixed = of[m].lightest = HUGE_VAL;
        of[m].is_wall = 0, of[m].rate = 1.0;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dem__present *q = &of[w->material[i]];
        double *least = dem__is_fixed(w, i) ? &q->fixed : &q->smallest;
        if (!w->alive[i]) continue;
        if (w->particle[i].radius < *least) *least = w->particle[i].radius;
        const dem__rigid *r = dem__rigid_of(w, i);
        if (least == &q->fixed || !r || r->first != i) continue;
        const dem_convex *s = dem__shape_of(w, i);
        const double rate = s ? s->rate : r->rate;
        q->lightest = r->mass / rate < q->lightest ? r->mass / rate : q->lightest;
        q->rate = rate > q->rate ? rate : q->rate;
    }
    for (int k = 0; k < w->walls; k++) of[w->wall[k].material].is_wall |= dem__has_surface(&w->wall[k]);
}

/* Returns the mass of the smallest sphere of a material, or the effective mass of a particle of a body if that is less
   [kg]. */
static inline double dem__mass_of(const dem_world *w, const dem__present *of, int m) {
    const double r = of[m].smallest, sphere = 4.0 / 3.0 * RIDDLE_PI * r * r * r * w->def.material[m].density;
    return sphere < of[m].lightest ? sphere : of[m].lightest;
}

/* Lowers the advised times to those that a pair needs. b->mass: the effective one, of which the contacts' damping knows
   nothing; rate: mass over effective mass. */
static inline void dem__advise_pair(const dem_birth *b, double speed, double rate, dem_advice *a) {
    double constants[DEM_CONSTANTS_MAX], contact, damping;
    if (b->features & DEM_HERTZ) {
        dem_prepare_hertz(b, constants);
        contact = dem_hertz_contact_time(0.75 * constants[DEM__HERTZ_K], constants[DEM__HERTZ_RADIUS], b->mass, speed);
        const double overlap = speed * contact / 2.943275175395;
        damping = constants[DEM__HERTZ_GAMMA] * sqrt(sqrt(constants[DEM__HERTZ_RADIUS] * overlap));
    } else {
        const double zeta = dem_damping_ratio(b->pair->restitution, b->pair->mode);
        contact = dem_contact_time(b->pair->stiffness, b->mass, zeta, b->pair->mode);
        damping = 2.0 * zeta * sqrt(b->pair->stiffness * b->mass);
    }
    a->contact = contact < a->contact ? contact : a->contact;
    damping *= sqrt(rate);
    if (damping > 0.0 && b->mass / damping < a->dashpot) a->dashpot = b->mass / damping;
}

/* The smallest step over all pairs of materials that are present, each with its smallest sphere. */
DEM_API dem_advice dem_advise(const dem_world *world, int features, double speed) {
    dem_advice a = {HUGE_VAL, HUGE_VAL, HUGE_VAL, (double)NAN, 0.0, 0.0};
    dem__present of[DEM_MATERIALS_MAX];
    const dem_world *w = world;
    if (!w || !w->def.allocator.fn || ((features & DEM_HERTZ) && !(speed > 0.0))) return a;
    dem__list_present(w, of);
    for (int m = 0; m < w->def.materials; m++) {
        if (!(of[m].smallest < HUGE_VAL)) continue;
        const dem_material *mat = &w->def.material[m];
        const double mass_m = dem__mass_of(w, of, m), shear = 0.5 * mat->young_modulus / (1.0 + mat->poisson_ratio);
        const double rayleigh =
            RIDDLE_PI * of[m].smallest * sqrt(mat->density / shear) / (0.1631 * mat->poisson_ratio + 0.8766);
        a.rayleigh = rayleigh < a.rayleigh ? rayleigh : a.rayleigh;
        for (int q = 0; q < w->def.materials; q++) {
            for (int side = 0; side < 3; side++) { /* 0: a sphere of material q, 1: a wall of it, 2: a fixed sphere */
                const double radius = side == 1 ? 0.0 : side ? of[q].fixed : of[q].smallest;
                dem_birth b;
                if (side == 1 ? !of[q].is_wall : !(radius < HUGE_VAL)) continue;
                const double mass_q = side ? HUGE_VAL : dem__mass_of(w, of, q);
                memset(&b, 0, sizeof b);
                b.def = &w->def;
                b.features = features;
                b.pair = m < q ? &w->def.pair[m][q] : &w->def.pair[q][m];
                b.material_i = m, b.material_j = q;
                b.radius_i = of[m].smallest, b.radius_j = radius;
                b.mass = side ? mass_m : mass_m * mass_q / (mass_m + mass_q);
                dem__advise_pair(&b, speed, !side && of[q].rate > of[m].rate ? of[q].rate : of[m].rate, &a);
            }
        }
    }
    dem__advise_stiffness(w, features, speed, &a);
    a.advised = a.contact / 20.0;
    if (0.5 * a.dashpot < a.advised) a.advised = 0.5 * a.dashpot;
    if ((features & DEM_HERTZ) && 0.2 * a.rayleigh < a.advised) a.advised = 0.2 * a.rayleigh;
    if (w->engine->convex.shapes > 0) a.advised *= 0.4; /* partial steps of their contacts are not corrected */
    return a;
}
