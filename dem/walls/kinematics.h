/* Where a wall is at a time, and how it moves there: by vibration, rotation, the caller's function, or a force. */
#pragma once
#include "../base/vectors.h"
#include "../../base/portable_math.h"

/* Returns the sine of an angle, and its cosine: the same bits as riddle_sin and riddle_cos, each of which reduces the
   angle again. */
static DEM__NOINLINE double dem__sine(double angle, double *cosine) {
    int quarter;
    const double r = riddle__within_quarter(angle, &quarter);
    *cosine = riddle__sin_quarter(r, quarter + 1);
    return riddle__sin_quarter(r, quarter);
}

/* Rotates v by an angle [rad] about a unit axis (Rodrigues). */
static DEM__NOINLINE dem_vec dem__rotated(dem_vec v, dem_vec axis, double angle) {
    double turns = angle / (2.0 * RIDDLE_PI), phase = 2.0 * RIDDLE_PI * (turns - floor(turns));
    double c, s = dem__sine(phase, &c);
    return dem__add(dem__add(dem__scale(c, v), dem__scale(s, dem__cross(axis, v))),
                    dem__scale((1.0 - c) * dem__dot(axis, v), axis));
}

/* Returns the displacement of a harmonic vibration from its start [m], and its velocity and acceleration. start: sine
   of the phase; angle: 2 pi times frequency and time. */
DEM_INLINE double dem__vibration(double amplitude, double phase, double start, double angle, double rate,
                                 double *velocity, double *acceleration) {
    if (amplitude == 0.0) {
        *velocity = *acceleration = 0.0;
        return 0.0;
    }
    double c, s = dem__sine(angle + phase, &c);
    *velocity = amplitude * rate * c;
    *acceleration = -amplitude * rate * rate * s;
    return amplitude * (s - start);
}

/* Sets the sines of a vibration's phases, which are constant. */
static inline void dem__set_phase_sine(dem_wall *w) {
    const dem_vec phase = w->asked.phase;
    w->phase_sine =
        dem_vec3(riddle_sin(phase.x) + 0.0, riddle_sin(phase.y) + 0.0, riddle_sin(phase.z) + 0.0); /* no -0 */
}

/* Displacement, velocity and acceleration of a vibrating wall. */
typedef struct dem__oscillation {
    dem_vec shift, velocity, acceleration;
} dem__oscillation;
static inline dem__oscillation dem__oscillation_at(const dem_wall *w, double t) {
    const double rate = 2.0 * RIDDLE_PI * w->asked.frequency, turns = w->asked.frequency * t;
    const double angle = 2.0 * RIDDLE_PI * (turns - floor(turns));
    const dem_vec size = w->asked.amplitude, phase = w->asked.phase, start = w->phase_sine;
    dem__oscillation s;
    s.shift.x = dem__vibration(size.x, phase.x, start.x, angle, rate, &s.velocity.x, &s.acceleration.x);
    s.shift.y = dem__vibration(size.y, phase.y, start.y, angle, rate, &s.velocity.y, &s.acceleration.y);
    s.shift.z = dem__vibration(size.z, phase.z, start.z, angle, rate, &s.velocity.z, &s.acceleration.z);
    return s;
}

/* Returns whether two walls vibrate alike, as a deck and its side wall do. */
DEM_INLINE int dem__oscillates_like(const dem_wall *a, const dem_wall *b) {
    return memcmp(&a->asked.amplitude, &b->asked.amplitude, sizeof a->asked.amplitude) == 0 &&
           memcmp(&a->asked.phase, &b->asked.phase, sizeof a->asked.phase) == 0 &&
           a->asked.frequency == b->asked.frequency && a->asked.motion_start == b->asked.motion_start;
}

/* Returns the position of a wall in a pose. axis: its axes in the pose. */
static inline dem_vec dem__posed(const dem_wall *w, const dem_pose *pose, dem_vec *axis) {
    const double angle = dem__length(pose->turn);
    dem_vec arm = dem__sub(w->asked.origin, w->asked.spin_centre);
    for (int k = 0; k < 3; k++) axis[k] = w->asked.rest_axis[k];
    if (angle != 0.0) { /* true for NaN, which is passed on */
        const dem_vec about = dem__scale(1.0 / angle, pose->turn);
        for (int k = 0; k < 3; k++) axis[k] = dem__rotated(axis[k], about, angle);
        arm = dem__rotated(arm, about, angle);
    }
    return dem__add(dem__add(w->asked.spin_centre, arm), pose->shift);
}

/* Moves a prescribed wall to its pose at a time. Its velocity, acceleration and spin are central differences. */
static inline void dem__prescribed_wall(dem_wall *w, double time) {
    dem_vec at[3], axis[3][3], omega = dem_vec3(0.0, 0.0, 0.0);
    const double rate = 0.5 / w->asked.interval;
    if (!w->asked.motion) return;
    for (int k = 0; k < 3; k++) {
        dem_pose pose;
        memset(&pose, 0, sizeof pose);
        w->asked.motion(w->asked.motion_user, time + (k - 1) * w->asked.interval, &pose);
        at[k] = dem__posed(w, &pose, axis[k]);
    }
    for (int k = 0; k < 3; k++) { /* omega = 1/2 sum of a x da/dt over the axes */
        w->axis[k] = axis[1][k];
        omega = dem__add(omega, dem__scale(0.5 * rate, dem__cross(axis[1][k], dem__sub(axis[2][k], axis[0][k]))));
    }
    w->position = at[1];
    w->velocity = dem__scale(rate, dem__sub(at[2], at[0]));
    w->acceleration = dem__scale(4.0 * rate * rate, dem__sub(dem__add(at[0], at[2]), dem__scale(2.0, at[1])));
    w->spin = dem__length(omega);
    if (w->spin > 0.0) w->spin_axis = dem__scale(1.0 / w->spin, omega);
}

/* Sets velocity and acceleration of a controlled wall at its present position. rate: its speed [m/s] or spin
   [rad/s]. */
static inline void dem__rated_wall(dem_wall *w, double rate) {
    if (w->asked.drive == DEM_FORCE_CONTROLLED) {
        w->velocity = dem__scale(rate, w->spin_axis), w->acceleration = dem__scale(w->rate_change, w->spin_axis);
        return;
    }
    const dem_vec arm = dem__sub(w->position, w->asked.spin_centre), across = dem__cross(w->spin_axis, arm);
    w->spin = rate, w->spin_rate = w->rate_change;
    w->velocity = dem__scale(rate, across);
    w->acceleration =
        dem__add(dem__scale(w->rate_change, across), dem__scale(rate, dem__cross(w->spin_axis, w->velocity)));
}

/* Moves a controlled wall to its position at a time, predicted from the last step like that of a particle. */
static inline void dem__controlled_wall(dem_wall *w, double time) {
    const double tau = time - w->asked.motion_start, way = w->coordinate + tau * (w->rate + 0.5 * tau * w->rate_change);
    dem_pose pose;
    memset(&pose, 0, sizeof pose);
    if (w->asked.drive == DEM_FORCE_CONTROLLED) pose.shift = dem__scale(way, w->spin_axis);
    else pose.turn = dem__scale(way, w->spin_axis);
    w->position = dem__posed(w, &pose, w->axis);
    dem__rated_wall(w, w->rate + tau * w->rate_change);
}

/* Moves a kinematic wall to where it is t after its motion began [s]. */
static inline void dem__kinematic_wall(dem_wall *w, double t, const dem__oscillation *sway) {
    const dem_vec shift = dem__add(sway->shift, dem__scale(t, w->asked.drift));
    w->velocity = dem__add(sway->velocity, w->asked.drift);
    w->acceleration = sway->acceleration;
    dem_vec origin = w->asked.origin;
    if (w->spin != 0.0) {
        double angle = w->spin * t;
        for (int k = 0; k < 3; k++) w->axis[k] = dem__rotated(w->asked.rest_axis[k], w->spin_axis, angle);
        dem_vec arm = dem__rotated(dem__sub(w->asked.origin, w->asked.spin_centre), w->spin_axis, angle),
                omega = dem__scale(w->spin, w->spin_axis);
        dem_vec turning = dem__cross(omega, arm);
        origin = dem__add(w->asked.spin_centre, arm);
        w->velocity = dem__add(w->velocity, turning);
        w->acceleration = dem__add(w->acceleration, dem__cross(omega, turning));
    }
    w->position = dem__add(origin, shift);
}

/* Moves a wall to where it is at a time [s]. */
static inline void dem__move_wall(dem_wall *w, double time) {
    if (w->asked.drive == DEM_PRESCRIBED) dem__prescribed_wall(w, time);
    else if (w->asked.drive != DEM_KINEMATIC) dem__controlled_wall(w, time);
    else {
        const dem__oscillation sway = dem__oscillation_at(w, time - w->asked.motion_start);
        dem__kinematic_wall(w, time - w->asked.motion_start, &sway);
    }
}
