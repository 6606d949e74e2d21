/* Setting walls in motion: vibrations, rotations, the caller's functions, forces and torques. */
#pragma once
#include "add.h"
#include "kinematics.h"

/* Moves a wall of the world, or a copy of one, to where it is at present. Its function may not change the world. */
static inline void dem__place_wall(dem_world *w, dem_wall *a) {
    w->engine->run.running = 1;
    dem__move_wall(a, w->time);
    w->engine->run.running = 0;
}

/* Begins a new kinematic motion where the wall is. Returns NULL if there is no such wall. */
static inline dem_wall *dem__rebase_wall(dem_world *w, int wall) {
    if (!w || wall < 0 || wall >= w->walls) return NULL;
    dem_wall *a = &w->wall[wall];
    dem__place_wall(w, a);
    const double t = w->time - a->asked.motion_start;
    const dem_vec sway = a->asked.drive == DEM_KINEMATIC ? dem__oscillation_at(a, t).shift : dem_vec3(0.0, 0.0, 0.0);
    a->asked.origin = a->position;
    for (int k = 0; k < 3; k++) a->asked.rest_axis[k] = a->axis[k];
    a->asked.spin_centre = dem__add(dem__add(a->asked.spin_centre, dem__scale(t, a->asked.drift)), sway);
    a->asked.motion_start = w->time;
    if (a->asked.drive != DEM_KINEMATIC)
        a->spin = a->spin_rate = a->spin_bound = 0.0; /* a drive is the wall's only motion */
    a->asked.drive = DEM_KINEMATIC;
    w->engine->run.needs_lists = 1;
    return a;
}

/* Returns whether a wall's surface moves unlike its origin: it may rotate, or is a belt. */
static inline int dem__slides(const dem_wall *a) {
    return a->asked.drive != DEM_KINEMATIC || a->spin != 0.0 || dem__is_belt(a);
}

/* Sets the limits of a kinematic wall's speed, acceleration and spin, on which timers rely. */
static inline void dem__bound_speed(dem_wall *a) {
    double rate = 2.0 * RIDDLE_PI * a->asked.frequency;
    const dem_vec n = a->axis[2];
    const double x = fabs(a->asked.amplitude.x), y = fabs(a->asked.amplitude.y), z = fabs(a->asked.amplitude.z);
    a->speed_bound = rate * (x + y + z) + dem__length(a->asked.drift);
    a->acceleration_bound = rate * rate * (x + y + z);
    a->side_bound =
        rate * rate *
        (x * sqrt(fabs(1.0 - n.x * n.x)) + y * sqrt(fabs(1.0 - n.y * n.y)) + z * sqrt(fabs(1.0 - n.z * n.z)));
    a->spin_bound = fabs(a->spin);
    a->slides = dem__slides(a);
}

DEM_API dem_status dem_vibrate(dem_world *world, int wall, dem_vec amplitude, dem_vec phase, double frequency) {
    if (dem__is_running(world)) return DEM_BUSY;
    if (dem__lacks_wall(world, wall)) return DEM_BAD_ARGUMENT;
    if (!dem__moderate_vec(amplitude)) return dem__refuse(world, "amplitude: a component is not finite or above 1e80");
    if (!(fabs(phase.x) < 1e3 && fabs(phase.y) < 1e3 && fabs(phase.z) < 1e3))
        return dem__refuse(world, "phase: a component is not finite or 1000 rad or more");
    if (!(frequency >= 0.0 && dem__moderate(frequency)))
        return dem__refuse(world, "frequency: below 0, not finite or above 1e80");
    dem_wall *a = dem__rebase_wall(world, wall);
    a->asked.amplitude = amplitude;
    a->asked.phase = phase;
    a->asked.frequency = frequency;
    dem__set_phase_sine(a);
    dem__bound_speed(a);
    return DEM_OK;
}

DEM_API dem_status dem_move(dem_world *world, int wall, dem_vec velocity) {
    if (dem__is_running(world)) return DEM_BUSY;
    if (dem__lacks_wall(world, wall)) return DEM_BAD_ARGUMENT;
    if (!dem__moderate_vec(velocity)) return dem__refuse(world, "velocity: a component is not finite or above 1e80");
    dem_wall *a = dem__rebase_wall(world, wall);
    a->asked.drift = velocity;
    dem__bound_speed(a);
    return DEM_OK;
}

DEM_API dem_status dem_rotate(dem_world *world, int wall, dem_vec centre, dem_vec axis, double spin) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_vec unit;
    if (dem__lacks_wall(world, wall)) return DEM_BAD_ARGUMENT;
    if (!dem__moderate_vec(centre)) return dem__refuse(world, "centre: a component is not finite or above 1e80");
    if (!dem__finite_vec(axis) || !dem__unit(axis, &unit))
        return dem__refuse(world, "axis: not finite, or of length 0");
    if (!dem__moderate(spin)) return dem__refuse(world, "spin: not finite or above 1e80");
    dem_wall *a = dem__rebase_wall(world, wall);
    a->asked.spin_centre = centre;
    a->spin_axis = unit;
    a->spin = spin;
    dem__bound_speed(a);
    return DEM_OK;
}

/* Makes a drive the only motion of a wall. */
static inline dem_wall *dem__drive(dem_world *w, int wall, dem_drive drive) {
    dem_wall *a = dem__rebase_wall(w, wall);
    a->asked.amplitude = a->asked.drift = dem_vec3(0.0, 0.0, 0.0);
    a->spin = a->spin_rate = a->coordinate = a->rate = a->rate_change = 0.0;
    a->speed_bound = a->spin_bound = 0.0; /* the first step sets them */
    a->asked.drive = (int)drive;
    a->slides = dem__slides(a);
    w->engine->run.needs_forces = 1; /* its acceleration must be computed */
    return a;
}

static inline int dem__wall_is_finite(const dem_wall *a) {
    return dem__finite_vec(a->position) && dem__finite_vec(a->velocity) && dem__finite_vec(a->acceleration) &&
           dem__finite(a->spin) && dem__finite_vec(a->axis[0]) && dem__finite_vec(a->axis[1]) &&
           dem__finite_vec(a->axis[2]);
}

DEM_API dem_status dem_prescribe(dem_world *world, int wall, dem_vec centre, dem_motion_fn motion, void *user) {
    if (dem__is_running(world)) return DEM_BUSY;
    if (dem__lacks_wall(world, wall)) return DEM_BAD_ARGUMENT;
    if (!motion) return dem__refuse(world, "motion: NULL");
    if (!dem__is_place(centre)) return dem__refuse(world, "centre: a coordinate is not finite or above 1e150");
    dem_wall *a = &world->wall[wall], before = *a, probe = *a;
    if (a->asked.drive != DEM_PRESCRIBED)
        probe.asked.origin = a->position, memcpy(probe.asked.rest_axis, a->axis, sizeof a->axis);
    probe.asked.drive = DEM_PRESCRIBED;
    probe.asked.spin_centre = centre;
    probe.asked.motion = motion, probe.asked.motion_user = user;
    probe.asked.interval = world->engine->run.dt;
    dem__place_wall(world, &probe);
    if (!dem__wall_is_finite(&probe))
        return dem__refuse(world, "motion: the pose or the velocity that it gives is not finite");
    if (before.asked.drive != DEM_PRESCRIBED)
        a = dem__drive(world, wall, DEM_PRESCRIBED), a->asked.interval = world->engine->run.dt;
    a->asked.spin_centre = centre;
    a->asked.motion = motion, a->asked.motion_user = user;
    world->engine->run.needs_lists = 1; /* another function may place it elsewhere */
    return DEM_OK;
}

/* Makes a force or a torque the only drive of a wall, which keeps its speed along the axis. */
static inline dem_status dem__control(dem_world *w, int wall, dem_drive drive, dem_vec centre, dem_vec axis,
                                      double inertia, double load, double damping) {
    if (dem__is_running(w)) return DEM_BUSY;
    dem_vec unit;
    const int turns = drive == DEM_TORQUE_CONTROLLED;
    if (dem__lacks_wall(w, wall)) return DEM_BAD_ARGUMENT;
    if (!dem__is_place(centre)) return dem__refuse(w, "centre: a coordinate is not finite or above 1e150");
    if (!dem__finite_vec(axis) || !dem__unit(axis, &unit)) return dem__refuse(w, "axis: not finite, or of length 0");
    if (!dem__positive(inertia))
        return dem__refuse(w, turns ? "inertia: not a finite number above 0" : "mass: not a finite number above 0");
    if (!dem__moderate(load / inertia))
        return dem__refuse(w, turns ? "torque: its acceleration is not finite or above 1e80"
                                    : "force: its acceleration is not finite or above 1e80");
    if (!(damping >= 0.0 && dem__moderate(damping / inertia)))
        return dem__refuse(w, "damping: below 0, not finite, or above 1e80 times the inertia");
    dem__place_wall(w, &w->wall[wall]);
    const dem_vec spin = dem__scale(w->wall[wall].spin, w->wall[wall].spin_axis);
    const double rate = dem__dot(drive == DEM_FORCE_CONTROLLED ? w->wall[wall].velocity : spin, unit);
    dem_wall *a = dem__drive(w, wall, drive);
    a->asked.spin_centre = centre;
    a->spin_axis = unit;
    a->asked.inertia = inertia;
    a->asked.load = load;
    a->asked.damping = damping;
    a->rate = rate;
    w->engine->walls.controls = 1;
    return DEM_OK;
}

DEM_API dem_status dem_control_force(dem_world *world, int wall, dem_vec axis, double mass, double force,
                                     double damping) {
    return dem__control(world, wall, DEM_FORCE_CONTROLLED, dem_vec3(0, 0, 0), axis, mass, force, damping);
}
DEM_API dem_status dem_control_torque(dem_world *world, int wall, dem_vec centre, dem_vec axis, double inertia,
                                      double torque, double damping) {
    return dem__control(world, wall, DEM_TORQUE_CONTROLLED, centre, axis, inertia, torque, damping);
}

DEM_API dem_status dem_set_belt(dem_world *world, int wall, dem_vec velocity) {
    if (dem__is_running(world)) return DEM_BUSY;
    if (dem__lacks_wall(world, wall)) return DEM_BAD_ARGUMENT;
    if (!dem__moderate_vec(velocity)) return dem__refuse(world, "velocity: a component is not finite or above 1e80");
    world->wall[wall].asked.belt = velocity;
    world->wall[wall].slides = dem__slides(&world->wall[wall]);
    return DEM_OK;
}

DEM_API dem_status dem_turn_belt(dem_world *world, int wall, dem_vec axis, double speed) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_vec unit;
    if (dem__lacks_wall(world, wall)) return DEM_BAD_ARGUMENT;
    if (!dem__finite_vec(axis) || !dem__unit(axis, &unit))
        return dem__refuse(world, "axis: not finite, or of length 0");
    if (!dem__moderate(speed)) return dem__refuse(world, "speed: not finite or above 1e80");
    world->wall[wall].asked.belt_turn = dem__scale(speed, unit);
    world->wall[wall].slides = dem__slides(&world->wall[wall]);
    return DEM_OK;
}

/* Computes the accelerations of controlled walls from the forces on them, and corrects their predicted rates. The
   damper is implicit. */
static inline void dem__kick_walls(dem_world *w, double h) {
    const dem__run *run = &w->engine->run;
    for (int k = 0; k < w->walls && w->engine->walls.controls; k++) {
        dem_wall *a = &w->wall[k];
        if (a->asked.drive < DEM_FORCE_CONTROLLED) continue;
        const dem_vec torque = dem__add(a->torque, dem__cross(dem__sub(a->position, a->asked.spin_centre), a->force));
        const double push = a->asked.load +
                            dem__dot(a->asked.drive == DEM_FORCE_CONTROLLED ? a->force : torque, a->spin_axis),
                     half = 0.5 * h;
        const double rate = (a->rate + half * (a->rate_change + push / a->asked.inertia)) /
                            (1.0 + half * a->asked.damping / a->asked.inertia);
        a->coordinate += h * (a->rate + half * a->rate_change);
        a->rate = dem__flushed(rate);
        a->rate_change = (push - a->asked.damping * rate) / a->asked.inertia;
        a->asked.motion_start = h > 0.0 ? run->start_time + (double)(w->step + 1 - run->start_step) * run->dt : w->time;
        dem__rated_wall(a, a->rate);
    }
}

/* Applies an impulse at a sphere's position, where the wall's normal is n, and an angular impulse to a wall, in
   addition to the forces of the step. */
static inline void dem__strike_wall(dem_wall *a, dem_vec place, dem_vec n, dem_vec impulse, dem_vec angular) {
    const dem_vec about_origin = dem__add(angular, dem__cross(dem__sub(place, a->position), impulse));
    dem__book_push(a, 1.0, impulse, about_origin, -dem__dot(impulse, dem__belt_velocity(a, n)));
    if (a->asked.drive < DEM_FORCE_CONTROLLED) return;
    const dem_vec turning = dem__add(angular, dem__cross(dem__sub(place, a->asked.spin_centre), impulse));
    a->rate += dem__dot(a->asked.drive == DEM_FORCE_CONTROLLED ? impulse : turning, a->spin_axis) / a->asked.inertia;
    dem__rated_wall(a, a->rate);
}

DEM_API dem_vec dem_wall_angular_impulse(const dem_world *world, int wall, dem_vec point) {
    if (!world || wall < 0 || wall >= world->walls) return dem_vec3((double)NAN, (double)NAN, (double)NAN);
    const dem_wall *a = &world->wall[wall];
    return dem__sub(a->angular_impulse, dem__cross(point, a->impulse));
}

DEM_API int dem_wall_acts(const dem_world *world, int wall, ptrdiff_t i) {
    return world && world->engine && wall >= 0 && wall < world->walls && i >= 0 && i < world->count &&
           dem__is_at_wall(world, i, wall);
}

DEM_API dem_status dem_set_wall_groups(dem_world *world, int wall, uint32_t groups) {
    if (dem__is_running(world)) return DEM_BUSY;
    if (dem__lacks_wall(world, wall)) return DEM_BAD_ARGUMENT;
    world->wall[wall].groups = groups;
    world->engine->run.needs_lists = world->engine->run.needs_forces = 1;
    return DEM_OK;
}

DEM_API dem_status dem_enable_wall(dem_world *world, int wall, int enabled) {
    if (dem__is_running(world)) return DEM_BUSY;
    if (dem__lacks_wall(world, wall)) return DEM_BAD_ARGUMENT;
    world->wall[wall].enabled = enabled != 0;
    world->engine->run.needs_lists = world->engine->run.needs_forces = 1;
    return DEM_OK;
}
