/* impact.h: two equal spheres of 5 mm hit each other: integrators as other codes have them, the exact outcome, and the
   same impact at all phases of the first step as pairs of one world of dem.h. For dem_accuracy and dem_steps. */
#ifndef RIDDLE_IMPACT_H
#define RIDDLE_IMPACT_H

#include <math.h>

#include "dem.h"

static const double diameter = 0.005, density = 2534.1, stiffness = 1e5, friction = 0.2, speed = 0.5;

static long evaluations; /* of the contact law, by the integrators below */

/* ---- dem.h without its resolved steps ---- */

/* A force whose contact part is declared 0 has no beginning and no end for the kernel: plain predicted Verlet at
   dem.h's own cost. */
DEM_INLINE void unresolved_force(const dem_contact *c, double *state, dem_response *r) {
    dem_law_linear_friction.force(c, state, r);
    r->contact = 0.0;
}
static double unresolved_prepare(const dem_birth *birth, double *constants) {
    dem_law_linear_friction.prepare(birth, constants);
    return 0.0;
}
static const dem_law unresolved_law = {"unresolved", 1, 3, 3, 1, 8, unresolved_prepare, unresolved_force, NULL, NULL};
DEM_KERNEL(unresolved_kernel, unresolved_law, DEM_LINEAR | DEM_FRICTION)

/* ---- integrators as others have them ---- */

/* Two equal spheres in a plane, seen from one of them; without spin at the start both spin alike. */
typedef struct pair_state {
    double x, y, vx, vy, spin, stretch; /* centre to centre, its velocity, spin of each, tangential displacement */
} pair_state;

typedef struct pair_law {
    double k, gamma, kt, mu, mass, inertia; /* mass: effective; inertia: of one sphere */
    int clipped;
} pair_law;

typedef struct pair_rate {
    double x, y, spin, stretch;
} pair_rate;

static inline double overlap_of(const pair_state *s) { return diameter - sqrt(s->x * s->x + s->y * s->y); }

/* Accelerations; advances the tangential displacement by dt. Returns the normal force, 0 outside contact. */
static inline double pair_force(const pair_law *law, pair_state *s, double dt, pair_rate *a) {
    const double distance = sqrt(s->x * s->x + s->y * s->y), nx = s->x / distance, ny = s->y / distance,
                 overlap = diameter - distance;
    const double closing = -(s->vx * nx + s->vy * ny), slip = s->vy * nx - s->vx * ny - distance * s->spin;
    double normal = 0.0, tangential = 0.0;
    evaluations++;
    a->stretch = slip;
    if (overlap > 0.0) {
        normal = law->k * overlap + law->gamma * closing;
        if (law->clipped && normal < 0.0) normal = 0.0;
        s->stretch += slip * dt;
        tangential = -law->kt * s->stretch;
        const double limit = law->mu * fmax(normal, 0.0);
        if (fabs(tangential) > limit) {
            tangential = copysign(limit, tangential);
            s->stretch = -tangential / law->kt;
        }
    }
    a->x = (normal * nx - tangential * ny) / law->mass;
    a->y = (normal * ny + tangential * nx) / law->mass;
    a->spin = -0.5 * distance * tangential / law->inertia;
    return normal;
}

/* One step. rate: of the state before and after; `dt` may be 0 to fill it. */
static inline void predicted_verlet(const pair_law *law, pair_state *s, pair_rate *a, double dt) {
    pair_state at = *s;
    pair_rate b;
    at.x += dt * (s->vx + 0.5 * dt * a->x), at.y += dt * (s->vy + 0.5 * dt * a->y);
    at.vx += dt * a->x, at.vy += dt * a->y, at.spin += dt * a->spin;
    pair_force(law, &at, dt, &b);
    at.vx = s->vx + 0.5 * dt * (a->x + b.x), at.vy = s->vy + 0.5 * dt * (a->y + b.y),
    at.spin = s->spin + 0.5 * dt * (a->spin + b.spin);
    *s = at;
    *a = b;
}

/* Force at new positions and the velocities of the half step; the same recursion as symplectic Euler. */
static inline void leapfrog(const pair_law *law, pair_state *s, pair_rate *a, double dt) {
    s->x += dt * s->vx, s->y += dt * s->vy;
    pair_force(law, s, dt, a);
    s->vx += dt * a->x, s->vy += dt * a->y, s->spin += dt * a->spin;
}

/* ---- impacts ---- */

typedef struct impact {
    double restitution, angle; /* against the normal [rad] */
    dem_restitution mode;
} impact;

static inline pair_law law_of(const impact *of) {
    pair_law law;
    const double sphere = RIDDLE_PI / 6.0 * diameter * diameter * diameter * density;
    law.k = stiffness;
    law.kt = 2.0 / 7.0 * stiffness;
    law.mu = friction;
    law.mass = 0.5 * sphere;
    law.inertia = 0.1 * sphere * diameter * diameter;
    law.gamma = 2.0 * dem_damping_ratio(of->restitution, of->mode) * sqrt(law.k * law.mass);
    law.clipped = of->mode == DEM_CLIPPED;
    return law;
}

static inline double contact_time_of(const impact *of) {
    return dem_contact_time(stiffness, law_of(of).mass, dem_damping_ratio(of->restitution, of->mode), of->mode);
}

/* The state `lead` before the spheres touch. */
static inline pair_state approach(const impact *of, double lead) {
    pair_state s = {diameter, 0.0, -speed * cos(of->angle), speed * sin(of->angle), 0.0, 0.0};
    s.x -= lead * s.vx, s.y -= lead * s.vy;
    return s;
}

/* From the very touch in small steps, the last one cut to the end of contact. */
static inline pair_state fine_outcome(const impact *of, int steps) {
    const pair_law law = law_of(of);
    const double dt = contact_time_of(of) / steps;
    pair_state s = approach(of, 0.0);
    pair_rate a;
    s.x -= 1e-15 * diameter;
    pair_force(&law, &s, 0.0, &a);
    for (int n = 0; n < 3 * steps; n++) {
        pair_state next = s;
        pair_rate after = a;
        predicted_verlet(&law, &next, &after, dt);
        pair_state ahead = next;
        pair_rate unused;
        if (overlap_of(&next) <= 0.0 || pair_force(&law, &ahead, 0.0, &unused) == 0.0) {
            double low = 0.0, high = dt;
            for (int k = 0; k < 60; k++) {
                const double middle = 0.5 * (low + high);
                next = s, after = a;
                predicted_verlet(&law, &next, &after, middle);
                ahead = next;
                if (overlap_of(&next) <= 0.0 || pair_force(&law, &ahead, 0.0, &unused) == 0.0) high = middle;
                else low = middle;
            }
            next = s, after = a;
            predicted_verlet(&law, &next, &after, low);
            return next;
        }
        s = next, a = after;
    }
    return s;
}

/* The exact velocities after the impact: the slip of a predicted velocity leaves an error of first order,
   taken out here. */
static inline pair_state exact_outcome(const impact *of) {
    const pair_state coarse = fine_outcome(of, 20000), fine = fine_outcome(of, 40000);
    pair_state exact = fine;
    exact.vx += fine.vx - coarse.vx, exact.vy += fine.vy - coarse.vy, exact.spin += fine.spin - coarse.spin;
    return exact;
}

/* All phases as so many pairs of one world. */
static inline dem_status world_of_pairs(dem_world *w, const impact *of, int division, int phases) {
    dem_def def = dem_default_def();
    const int glass = dem_add_material(&def, density, 5e10, 0.2);
    dem_pair_def *pair = dem_pair(&def, glass, glass);
    pair->stiffness = stiffness;
    pair->restitution = of->restitution;
    pair->mode = of->mode;
    pair->friction = friction;
    def.gravity = dem_vec3(0.0, 0.0, 0.0);
    def.dt = contact_time_of(of) / division;
    dem_status status = dem_init(w, &def, NULL);
    for (int p = 0; p < phases && status == DEM_OK; p++) {
        const pair_state s = approach(of, def.dt * (1.0 + (p + 0.5) / phases));
        const double z = 3.0 * diameter * p, diameters[2] = {diameter, diameter};
        const double centres[6] = {0.5 * s.x, 0.5 * s.y, z, -0.5 * s.x, -0.5 * s.y, z};
        status = dem_add_spheres(w, 2, centres, diameters, glass, 0);
        if (status == DEM_OK)
            status = dem_set_motion(w, 2 * p, dem_vec3(0.5 * s.vx, 0.5 * s.vy, 0.0), dem_vec3(0.0, 0.0, 0.0));
        if (status == DEM_OK)
            status = dem_set_motion(w, 2 * p + 1, dem_vec3(-0.5 * s.vx, -0.5 * s.vy, 0.0), dem_vec3(0.0, 0.0, 0.0));
    }
    return status;
}

#endif
