/* The state of what moves: its origin, energies and accelerations. A particle moves by itself, with its rigid body, or,
   where it is fixed, not at all. Only this folder asks which of these applies. */
#pragma once
#include "../base/definition.h"
#include "../energy/postings.h"
#include "motion.h"

/* Makes the present step the origin of particle i: it stores the present state of its parabola. */
static inline void dem__set_origin(dem_world *w, ptrdiff_t i) {
    dem__rigid *r = dem__rigid_of(w, i);
    if (r) {
        w->engine->bodies.calls->set_origin(w, r);
        return;
    }
    const double tau = dem__now(w, i);
    dem_particle *p = &w->particle[i];
    p->x = dem__at(w, i, tau), p->v = dem__velocity_at(w, i, tau), p->spin = dem__spin_at(w, i, tau);
    w->particle[i].origin = w->step;
}

/* Gives particle i, or its rigid body, a new parabola from here on. */
static inline void dem__begin_parabola(dem_world *w, ptrdiff_t i, dem_vec x, dem_vec v, dem_vec a) {
    dem__rigid *r = dem__rigid_of(w, i);
    dem_particle *p = &w->particle[i];
    if (r) {
        w->engine->bodies.calls->set_origin(w, r);
        r->x = x, r->v = v, r->a = a;
        w->engine->bodies.calls->place(w, r);
        return;
    }
    p->spin = dem__spin_at(w, i, dem__now(w, i));
    p->x = x, p->v = v, p->a = a;
    p->origin = w->step;
}

/* Changes the velocity of particle i, or of its body, at an origin that has just been set. */
static inline void dem__add_velocity(dem_world *w, ptrdiff_t i, dem_vec change) {
    dem__rigid *r = dem__rigid_of(w, i);
    if (r) {
        r->v = dem__add(r->v, change);
        w->engine->bodies.calls->place(w, r);
    } else w->particle[i].v = dem__add(w->particle[i].v, change);
}

/* Puts x, where particle i or the centre of its body is, back into the periodic box. Where gravity has a component
   along the box, it gains potential energy, which is booked. */
DEM_INLINE void dem__put_in_box(dem_world *w, ptrdiff_t i, dem_vec *x) {
    const dem_vec in = dem__in_box(w, *x);
    if (!dem__is_fixed(w, i)) dem__book_wrap(w, -w->particle[i].mass * dem__dot(dem__free_fall(w), dem__sub(in, *x)));
    *x = in;
}
/* Puts the stored position of particle i, or of its body, back into the box. */
DEM_INLINE void dem__wrap(dem_world *w, ptrdiff_t i) {
    dem__rigid *r = dem__rigid_of(w, i);
    dem__put_in_box(w, i, r ? &r->x : &w->particle[i].x);
}

/* Returns the number of rigid bodies present. The array keeps removed bodies until lists are rebuilt. */
static inline ptrdiff_t dem__bodies_present(const dem_world *w) {
    const dem__bodies *bodies = &w->engine->bodies;
    ptrdiff_t present = 0;
    for (ptrdiff_t k = 0; k < bodies->rigid_count; k++) present += w->alive[bodies->rigid[k].first] != DEM_GONE;
    return present;
}

DEM_INLINE double dem__inertia(const dem_world *w, ptrdiff_t i) {
    return 0.4 * w->particle[i].mass * w->particle[i].radius * w->particle[i].radius;
}

/* Changes the angular momentum of particle i, or of its body, at an origin that has just been set. */
static inline void dem__add_angular_momentum(dem_world *w, ptrdiff_t i, dem_vec change) {
    dem__rigid *r = dem__rigid_of(w, i);
    if (r) {
        r->momentum = dem__add(r->momentum, change);
        w->engine->bodies.calls->place(w, r);
    } else w->particle[i].spin = dem__plus(w->particle[i].spin, 1.0 / dem__inertia(w, i), change);
}

/* Returns the diameter of particle i, or of a sphere with the mass of its body and the material of its first particle
   [m]. */
static inline double dem__diameter_of(const dem_world *w, ptrdiff_t i) {
    const dem__rigid *r = dem__rigid_of(w, i);
    return r ? riddle_cbrt(6.0 / RIDDLE_PI * r->mass / w->def.material[w->material[r->first]].density)
             : 2.0 * w->particle[i].radius;
}

/* Returns what a contact of i and j counts on, of a mass or a moment of inertia of each: a fixed particle counts as
   infinitely heavy. */
DEM_INLINE double dem__reduced(const dem_world *w, ptrdiff_t i, ptrdiff_t j, double of_i, double of_j) {
    return dem__is_fixed(w, j) ? of_i : dem__is_fixed(w, i) ? of_j : of_i * of_j / (of_i + of_j);
}

/* Predicts how an impact that has just begun changes the velocities of i and j by its middle, when both have the normal
   velocity of their common centre of mass. New bounds rely on it. */
DEM_INLINE void dem__expect_impact(dem_world *w, ptrdiff_t i, ptrdiff_t j, dem_vec n, double closing) {
    if (!(closing > 0.0)) return; /* the contact has ended */
    double part = j < 0 ? 1.0 : w->particle[j].mass / (w->particle[i].mass + w->particle[j].mass);
    if (w->engine->bodies.has_fixed && j >= 0) part = dem__is_fixed(w, i) ? 0.0 : dem__is_fixed(w, j) ? 1.0 : part;
    w->engine->bodies.impact[i] = dem__scale(part * closing, n);
    if (j >= 0) w->engine->bodies.impact[j] = dem__scale((part - 1.0) * closing, n);
}

/* Returns the kinetic energy of particle i [J]. The energies of a rigid body are those of its first particle, so that
   sums over particles count it once. A fixed particle, like a wall, has none. */
DEM_INLINE double dem__kinetic(const dem_world *w, ptrdiff_t i) {
    const dem__rigid *r = dem__rigid_of(w, i);
    if (dem__is_fixed(w, i)) return 0.0;
    if (r) {
        const dem_vec u = dem__plus(r->v, dem__now(w, i), r->a);
        return r->first == i ? 0.5 * r->mass * dem__dot(u, u) : 0.0;
    }
    dem_vec v = dem__velocity_at(w, i, dem__now(w, i));
    return 0.5 * w->particle[i].mass * dem__dot(v, v);
}
DEM_INLINE double dem__rotational(const dem_world *w, ptrdiff_t i) {
    const dem__rigid *r = dem__rigid_of(w, i);
    if (dem__is_fixed(w, i)) return 0.0;
    if (r) {
        const dem__pose p = dem__pose_at(w, r, dem__now(w, i));
        return r->first == i ? 0.5 * dem__dot(p.spin, p.momentum) : 0.0;
    }
    const dem_vec s = dem__spin_at(w, i, dem__now(w, i));
    return 0.5 * dem__inertia(w, i) * dem__dot(s, s);
}
DEM_INLINE double dem__motion_energy(const dem_world *w, ptrdiff_t i) {
    return dem__kinetic(w, i) + dem__rotational(w, i);
}
DEM_INLINE double dem__potential(const dem_world *w, ptrdiff_t i) {
    const dem__rigid *r = dem__rigid_of(w, i);
    if (dem__is_fixed(w, i)) return 0.0;
    if (r) {
        const double tau = dem__now(w, i);
        const dem_vec x = dem__plus(r->x, tau, dem__plus(r->v, 0.5 * tau, r->a));
        return r->first == i ? -r->mass * dem__dot(dem__free_fall(w), x) : 0.0;
    }
    return -w->particle[i].mass * dem__dot(dem__free_fall(w), dem__at(w, i, dem__now(w, i)));
}

/* Makes the present step the origin of particle i, which the caller changes between runs. In a force field it gets the
   most accurate velocity that is known. */
static inline void dem__restart(dem_world *w, ptrdiff_t i) {
    const dem_vec error = dem__velocity_error(w, i, dem__now(w, i));
    dem__set_origin(w, i);
    DEM__TELL(w, correct_velocity, (w, i, error));
}

DEM_INLINE double dem__nearest(double d, double length) {
    return fabs(d) < 0.499999 * length ? d : d - length * floor(d / length + 0.5);
}

DEM_INLINE dem_vec dem__nearest_image(const dem_world *w, dem_vec d) {
    if (w->engine->run.has_periodic) {
        if (w->def.periodic[0]) d.x = dem__nearest(d.x, w->def.high.x - w->def.low.x);
        if (w->def.periodic[1]) d.y = dem__nearest(d.y, w->def.high.y - w->def.low.y);
        if (w->def.periodic[2]) d.z = dem__nearest(d.z, w->def.high.z - w->def.low.z);
    }
    return d;
}

static inline dem__pieces dem__all_particles(const dem_world *w) {
    dem__pieces all;
    all.first = 0, all.end = w->count;
    return all;
}

/* Begin and end a change by the caller of how some particles move. */
static inline void dem__begin_change(dem_world *w, dem__pieces of) { DEM__TELL(w, begin_change, (w, of)); }
static inline void dem__end_change(dem_world *w, dem__pieces of) { DEM__TELL(w, end_change, (w, of)); }

/* Sets the factors that turn forces on particle i into accelerations. */
static inline void dem__set_inverse_mass(dem_world *w, ptrdiff_t i) {
    dem__sum *sum = &w->engine->bodies.sum[i];
    sum->per_mass = dem__per_mass(w, i);
    sum->per_inertia = 2.5 * sum->per_mass / (w->particle[i].radius * w->particle[i].radius);
}

/* Sets the share of a particle's mass in each of its contacts. */
DEM_INLINE void dem__set_mass_share(dem_world *w, ptrdiff_t i) {
    w->engine->bodies.mass_share[i] = w->touching[i] > 1 && !dem__is_fixed(w, i) ? 1.0 / (double)w->touching[i] : 1.0;
}

/* Sets the acceleration that particle i has without contacts. */
static inline void dem__free_acceleration(dem_world *w, ptrdiff_t i) {
    dem__bodies *bodies = &w->engine->bodies;
    dem__rigid *r = dem__rigid_of(w, i);
    if (r) {
        bodies->calls->fall(w, r);
        return;
    }
    if (dem__is_fixed(w, i)) {
        w->particle[i].a = w->spin_rate[i] = dem_vec3(0.0, 0.0, 0.0);
        return;
    }
    const dem__sum *sum = &bodies->sum[i];
    w->particle[i].a = dem__plus(dem__free_fall(w), sum->per_mass, dem__first(bodies->load[i]));
    w->spin_rate[i] = dem__scale(sum->per_inertia, dem__second(bodies->load[i]));
}

DEM_INLINE int dem__has_load(const dem_world *w, ptrdiff_t i) {
    const double *e = w->engine->bodies.external[i];
    return e[0] != 0.0 || e[1] != 0.0 || e[2] != 0.0 || e[3] != 0.0 || e[4] != 0.0 || e[5] != 0.0;
}

/* Returns whether particle i, or any particle of its rigid body, has a load or is fixed. */
DEM_INLINE int dem__is_loaded(const dem_world *w, ptrdiff_t i) {
    const dem__pieces own = dem__pieces_of(w, i);
    int loaded = dem__is_fixed(w, i); /* a fixed particle does not fall */
    for (ptrdiff_t k = own.first; k < own.end; k++) loaded |= dem__has_load(w, k);
    return loaded;
}

/* Makes particle i take steps from here on. */
DEM_INLINE void dem__wake_one(dem_world *w, ptrdiff_t i) {
    dem__bodies *bodies = &w->engine->bodies;
    if (bodies->activity[i]) return;
    bodies->activity[i] = 1;
    bodies->active_at[i] = (int32_t)bodies->active_count;
    bodies->active[bodies->active_count++] = (int32_t)i;
}
/* Makes particle i, or all particles of its rigid body, take steps from here on. */
DEM_INLINE void dem__wake(dem_world *w, ptrdiff_t i) {
    const dem__pieces own = dem__pieces_of(w, i);
    for (ptrdiff_t k = own.first; k < own.end; k++) dem__wake_one(w, k);
}

/* Returns the rotation from the principal axes of the body of particle i to the frame in which its shape was given. */
static inline dem_quaternion dem__given_frame(const dem_world *w, ptrdiff_t i, const dem__rigid *r) {
    const dem_convex *s = dem__shape_of(w, i);
    if (!s || dem__is_part(w, i)) return r->frame;
    const dem_quaternion own = dem__turn_of_shape(s);
    return own.w != 1.0 ? dem__turns(own, r->frame) : r->frame;
}

/* Returns the position of the centre of particle i, or of its rigid body, now, within the periodic box. */
static inline dem_vec dem__centre_now(const dem_world *w, ptrdiff_t i) {
    return dem__in_box(w, dem__centre_at(w, i, dem__now(w, i)));
}

static inline int dem__is_present(const dem_world *w, ptrdiff_t i) {
    return w && i >= 0 && i < w->count && w->alive[i];
}
