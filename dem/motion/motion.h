/* Where particles are at a time after their origin step: a sphere on a parabola, a particle of a rigid body turned
   about one. Reads bodies. Promises: the same bits whenever a state is evaluated.

   A rigid body (dem__rigid) has the orientation, mass and moments. Its particles (dem_particle) touch others; they are
   consecutive in the world's arrays. Their mass is the body's, and their contacts count for all of them. Their x, v, a
   and spin are those of their centres as parts of the body, valid at the origin step and while forces are computed. In
   flight use dem__at and its like, never the parabola. */
#pragma once
#include "../base/arrays.h"
#include "rotation.h"

/* Returns the force of a wrench, its first vector. */
DEM_INLINE dem_vec dem__first(const double *six) { return dem_vec3(six[0], six[1], six[2]); }
/* Returns the torque of a wrench, its second vector. */
DEM_INLINE dem_vec dem__second(const double *six) { return dem_vec3(six[3], six[4], six[5]); }

/* Returns whether particle i, or the rigid body that it is a part of, is fixed. */
DEM_INLINE int dem__is_fixed(const dem_world *w, ptrdiff_t i) {
    return w->engine->bodies.has_fixed && w->engine->bodies.fixed[i].on != 0;
}

/* Returns the acceleration of a particle in flight without loads [m/s2]. Bounds and the list rely on its being the same
   for all particles. */
DEM_INLINE dem_vec dem__free_fall(const dem_world *w) { return w->def.gravity; }

/* Returns the time since the origin step of particle i [s]. */
DEM_INLINE double dem__now(const dem_world *w, ptrdiff_t i) {
    return (double)(w->step - w->particle[i].origin) * w->engine->run.dt;
}

DEM_INLINE double dem__wrapped(double v, double low, double high) {
    if (v >= low && v < high) return v;
    const double length = high - low, x = v - length * floor((v - low) / length);
    return x < low ? low : x > high ? high : x; /* rounding, very far away */
}
DEM_INLINE dem_vec dem__in_box(const dem_world *w, dem_vec x) {
    const dem_def *d = &w->def;
    if (d->periodic[0]) x.x = dem__wrapped(x.x, d->low.x, d->high.x);
    if (d->periodic[1]) x.y = dem__wrapped(x.y, d->low.y, d->high.y);
    if (d->periodic[2]) x.z = dem__wrapped(x.z, d->low.z, d->high.z);
    return x;
}

/* Returns the rigid body of particle i, or NULL. */
DEM_INLINE dem__rigid *dem__rigid_of(const dem_world *w, ptrdiff_t i) {
    const dem__bodies *bodies = &w->engine->bodies;
    return bodies->rigid && bodies->rigid_of[i] > 0 ? &bodies->rigid[bodies->rigid_of[i] - 1] : NULL;
}

/* Returns the particles of particle i's rigid body, or i alone. */
DEM_INLINE dem__pieces dem__pieces_of(const dem_world *w, ptrdiff_t i) {
    const dem__rigid *r = dem__rigid_of(w, i);
    dem__pieces own;
    own.first = r ? r->first : i, own.end = own.first + (r ? r->pieces : 1);
    return own;
}

/* Returns whether particle i stands for all that moves as one: a single sphere, or the first particle of a body. */
DEM_INLINE int dem__leads(const dem_world *w, ptrdiff_t i) { return dem__pieces_of(w, i).first == i; }

/* Returns whether i and j cannot meet: particles of one body, or both fixed. */
DEM_INLINE int dem__cannot_meet(const dem_world *w, ptrdiff_t i, ptrdiff_t j) {
    const dem__rigid *r = dem__rigid_of(w, i);
    return (r && r == dem__rigid_of(w, j)) || (dem__is_fixed(w, i) && dem__is_fixed(w, j));
}

/* Returns whether a rigid body takes part in a contact of i and j; j < 0: of a wall. */
DEM_INLINE int dem__has_body(const dem_world *w, ptrdiff_t i, ptrdiff_t j) {
    return dem__rigid_of(w, i) || (j >= 0 && dem__rigid_of(w, j));
}

/* Returns whether particle i is a sphere that forces move: neither a part of a body nor fixed. */
DEM_INLINE int dem__is_free_sphere(const dem_world *w, ptrdiff_t i) {
    return !dem__rigid_of(w, i) && !dem__is_fixed(w, i);
}

/* Returns the acceleration of particle i, or of its rigid body, divided by the force on it [1/kg]; 0 if it is fixed. */
DEM_INLINE double dem__per_mass(const dem_world *w, ptrdiff_t i) {
    return dem__is_fixed(w, i) ? 0.0 : 1.0 / w->particle[i].mass;
}

DEM_INLINE dem__pose dem__pose_at(const dem_world *w, const dem__rigid *r, double tau) {
    return w->engine->bodies.calls->pose(w, r, tau);
}
/* Returns the centre of mass of a body alone. */
DEM_INLINE dem_vec dem__body_at(const dem__rigid *r, double tau) {
    return dem__plus(r->x, tau, dem__plus(r->v, 0.5 * tau, r->a));
}

/* Returns the orientation of the principal axes of particle i's body, tau after its origin step [s]. */
static inline dem_quaternion dem__body_turn_at(const dem_world *w, ptrdiff_t i, double tau) {
    return w->engine->bodies.calls->turn(w, dem__rigid_of(w, i), tau);
}
/* Returns the orientation of a polyhedron's own axes, from that of its body. The body's axes may have another order; a
   part of a compound has a turn of its own. */
static inline dem_quaternion dem__turn_of_polyhedron(const dem_world *w, ptrdiff_t i, dem_quaternion turn) {
    return dem__turns(turn,
                      dem__is_part(w, i) ? w->engine->convex.part[i] : dem__opposite_turn(dem__rigid_of(w, i)->frame));
}

/* Returns the greatest speed in flight of a point of particle i's body that is an arm [m] away from its centre,
   relative to it [m/s]. */
DEM_INLINE double dem__turning_speed_at(const dem_world *w, ptrdiff_t i, double arm) {
    return w->engine->bodies.calls->turning_speed(dem__rigid_of(w, i), arm);
}
/* Returns the same of the centre of particle i; 0 for a sphere. */
DEM_INLINE double dem__turning_speed_of(const dem_world *w, ptrdiff_t i) {
    return dem__rigid_of(w, i) ? dem__turning_speed_at(w, i, dem__length(w->engine->bodies.offset[i])) : 0.0;
}

/* Returns the vector from the centre of particle i's body to the particle now; 0 for a sphere. */
static inline dem_vec dem__arm_now(const dem_world *w, ptrdiff_t i) {
    return dem__rigid_of(w, i) ? dem__to_lab(dem__body_turn_at(w, i, dem__now(w, i)), w->engine->bodies.offset[i])
                               : dem_vec3(0.0, 0.0, 0.0);
}

/* Return position and velocity of a particle of a rigid body, tau after its origin step [s]. */
static DEM__NOINLINE dem_vec dem__piece_at(const dem_world *w, const dem__rigid *r, ptrdiff_t i, double tau) {
    return dem__add(dem__body_at(r, tau), dem__to_lab(dem__body_turn_at(w, i, tau), w->engine->bodies.offset[i]));
}
static DEM__NOINLINE dem_vec dem__piece_velocity_at(const dem_world *w, const dem__rigid *r, ptrdiff_t i, double tau) {
    const dem__pose p = dem__pose_at(w, r, tau);
    return dem__add(p.v, dem__cross(p.spin, dem__to_lab(p.turn, w->engine->bodies.offset[i])));
}

/* Returns the position of a sphere on its parabola, tau after its origin step [s]. */
DEM_INLINE dem_vec dem__sphere_at(const dem_world *w, ptrdiff_t i, double tau) {
    const dem_particle *p = &w->particle[i];
    return dem__plus(p->x, tau, dem__plus(p->v, 0.5 * tau, p->a));
}
DEM_INLINE dem_vec dem__sphere_velocity_at(const dem_world *w, ptrdiff_t i, double tau) {
    return dem__plus(w->particle[i].v, tau, w->particle[i].a);
}
DEM_INLINE dem_vec dem__sphere_spin_at(const dem_world *w, ptrdiff_t i, double tau) {
    return dem__plus(w->particle[i].spin, tau, w->spin_rate[i]);
}

/* Returns the position of any particle, tau after its origin step [s]. */
DEM_INLINE dem_vec dem__at(const dem_world *w, ptrdiff_t i, double tau) {
    const dem__rigid *r = dem__rigid_of(w, i);
    return r ? dem__piece_at(w, r, i, tau) : dem__sphere_at(w, i, tau);
}
DEM_INLINE dem_vec dem__velocity_at(const dem_world *w, ptrdiff_t i, double tau) {
    const dem__rigid *r = dem__rigid_of(w, i);
    return r ? dem__piece_velocity_at(w, r, i, tau) : dem__sphere_velocity_at(w, i, tau);
}
/* Return position and velocity of the centre of particle i, or of its rigid body, on its parabola. */
DEM_INLINE dem_vec dem__centre_at(const dem_world *w, ptrdiff_t i, double tau) {
    const dem__rigid *r = dem__rigid_of(w, i);
    return r ? dem__plus(r->x, tau, dem__plus(r->v, 0.5 * tau, r->a)) : dem__sphere_at(w, i, tau);
}
DEM_INLINE dem_vec dem__drift_at(const dem_world *w, ptrdiff_t i, double tau) {
    const dem__rigid *r = dem__rigid_of(w, i);
    return r ? dem__plus(r->v, tau, r->a) : dem__sphere_velocity_at(w, i, tau);
}
/* Returns the velocity of the same centre as it is stored. */
DEM_INLINE dem_vec dem__centre_velocity(const dem_world *w, ptrdiff_t i) {
    const dem__rigid *r = dem__rigid_of(w, i);
    return r ? r->v : w->particle[i].v;
}
/* Returns the acceleration of the centre of particle i, or of its body. */
DEM_INLINE dem_vec dem__centre_pull(const dem_world *w, ptrdiff_t i) {
    const dem__rigid *r = dem__rigid_of(w, i);
    return r ? r->a : w->particle[i].a;
}
/* Returns by how much a velocity on the parabola is too small [m/s]. In a force field a parabola has the right
   positions at both ends of a flight, but not the right velocities. */
static inline dem_vec dem__velocity_error(const dem_world *w, ptrdiff_t i, double tau) {
    dem_vec error = dem_vec3(0.0, 0.0, 0.0);
    DEM__GET(w, error, velocity_error, (w, i, tau));
    return error;
}
/* Return the velocity of particle i, and of its centre or that of its body, as accurately as they are known. */
static inline dem_vec dem__true_velocity_at(const dem_world *w, ptrdiff_t i, double tau) {
    return dem__add(dem__velocity_at(w, i, tau), dem__velocity_error(w, i, tau));
}
static inline dem_vec dem__true_drift_at(const dem_world *w, ptrdiff_t i, double tau) {
    return dem__add(dem__drift_at(w, i, tau), dem__velocity_error(w, i, tau));
}
DEM_INLINE dem_vec dem__spin_at(const dem_world *w, ptrdiff_t i, double tau) {
    const dem__rigid *r = dem__rigid_of(w, i);
    return r ? dem__pose_at(w, r, tau).spin : dem__sphere_spin_at(w, i, tau);
}
