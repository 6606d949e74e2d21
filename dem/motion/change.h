/* What a caller changes between runs: motion, orientation, load, gravity, the time step. */
#pragma once
#include "state.h"

DEM_API dem_status dem_set_time_step(dem_world *world, double dt) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (dem__lacks_memory(w)) return DEM_BAD_ARGUMENT;
    if (!dem__is_time_step(dt)) return dem__refuse(w, "dt: not 1e-60 s or more and below 1e6 s");
    dem__begin_change(w, dem__all_particles(w));
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i]) dem__restart(w, i);
    }
    w->engine->run.start_time = w->time;
    w->engine->run.start_step = w->step;
    w->def.dt = w->engine->run.dt = dt;
    DEM__TELL(w, set_time_step, (w));
    dem__end_change(w, dem__all_particles(w));
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    return DEM_OK;
}

DEM_API dem_status dem_set_gravity(dem_world *world, dem_vec gravity) {
    dem_world *w = world;
    if (dem__is_running(w)) return DEM_BUSY;
    if (dem__lacks_memory(w)) return DEM_BAD_ARGUMENT;
    if (!dem__moderate_vec(gravity)) return dem__refuse(w, "gravity: a component is not finite or above 1e80");
    const dem_vec change = dem__sub(gravity, w->def.gravity);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i] || dem__is_fixed(w, i)) continue;
        dem__rigid *r = dem__rigid_of(w, i);
        dem__restart(w, i);
        w->particle[i].a = dem__add(w->particle[i].a, change);
        if (!dem__leads(w, i)) continue;
        if (r) r->a = dem__add(r->a, change);
        dem__book_gravity(w, -w->particle[i].mass * dem__dot(change, r ? r->x : w->particle[i].x));
    }
    w->def.gravity = gravity;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i] && !w->touching[i]) dem__free_acceleration(w, i);
    }
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    return DEM_OK;
}

DEM_API dem_status dem_set_motion(dem_world *world, ptrdiff_t i, dem_vec velocity, dem_vec spin) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (dem__lacks_particle(w, i)) return DEM_BAD_ARGUMENT;
    if (!dem__moderate_vec(velocity)) return dem__refuse(w, "velocity: a component is not finite or above 1e80");
    if (!dem__moderate_vec(spin)) return dem__refuse(w, "spin: a component is not finite or above 1e80");
    dem__rigid *r = dem__rigid_of(w, i);
    if (r) i = r->first;
    if (r && dem__is_fixed(w, i) && dem__dot(spin, spin) > 0.0)
        return dem__refuse(w, "spin: a fixed body does not turn");
    dem__begin_change(w, dem__pieces_of(w, i));
    dem__restart(w, i);
    dem__book_motion(w, -dem__motion_energy(w, i));
    w->particle[i].v = dem__flushed_vec(velocity);
    w->particle[i].spin = dem__flushed_vec(spin);
    if (r) w->engine->bodies.calls->set_motion(w, r, dem__flushed_vec(velocity), dem__flushed_vec(spin));
    dem__book_motion(w, dem__motion_energy(w, i));
    dem__end_change(w, dem__pieces_of(w, i));
    w->engine->run.needs_lists = 1;
    return DEM_OK;
}

DEM_API dem_status dem_set_load(dem_world *world, ptrdiff_t i, dem_vec force, dem_vec torque) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (dem__lacks_particle(w, i)) return DEM_BAD_ARGUMENT;
    if (!dem__moderate_vec(dem__scale(1.0 / w->particle[i].mass, force)))
        return dem__refuse(w, "force: its acceleration is not finite or above 1e80");
    if (!dem__moderate_vec(dem__scale(1.0 / dem__inertia(w, i), torque)))
        return dem__refuse(w, "torque: its angular acceleration is not finite or above 1e80");
    dem__begin_change(w, dem__pieces_of(w, i));
    dem__restart(w, i);
    double *load = w->engine->bodies.load[i], *external = w->engine->bodies.external[i];
    dem_vec *const rate[] = {&w->particle[i].a, &w->spin_rate[i]};
    const double wanted[] = {force.x, force.y, force.z, torque.x, torque.y, torque.z};
    dem__rigid *r = dem__rigid_of(w, i);
    if (r && !dem__is_fixed(w, i)) {
        const dem_vec more = dem__sub(force, dem__first(external));
        r->a = dem__plus(r->a, 1.0 / r->mass, more);
        r->torque = dem__add(dem__add(r->torque, dem__sub(torque, dem__second(external))),
                             dem__cross(w->engine->bodies.arm[i], more));
    }
    const int fixed = dem__is_fixed(w, i);
    for (int a = 0; a < 6; a++) {
        const double change = wanted[a] - external[a];
        if (!fixed) *dem_axis_of(rate[a / 3], a % 3) += change / (a < 3 ? w->particle[i].mass : dem__inertia(w, i));
        load[a] = load[a] == external[a] ? wanted[a] : load[a] + change; /* links add their own */
        external[a] = wanted[a];
    }
    if (r) w->engine->bodies.calls->place(w, r);
    if (!w->touching[i]) dem__free_acceleration(w, i);
    dem__end_change(w, dem__pieces_of(w, i));
    dem__wake(w, i); /* a loaded particle is not in free flight */
    w->engine->bodies.loads_on = w->engine->run.needs_lists = 1;
    return DEM_OK;
}

DEM_API dem_status dem_set_orientation(dem_world *world, ptrdiff_t i, dem_quaternion orientation) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    dem_quaternion q;
    if (dem__lacks_particle(w, i)) return DEM_BAD_ARGUMENT;
    if (!dem__unit_turn(orientation, &q)) return dem__refuse(w, "orientation: 0 or not finite");
    dem__rigid *r = dem__rigid_of(w, i);
    if (!r) return dem__refuse(w, "i: a single sphere, which has no orientation");
    dem__begin_change(w, dem__pieces_of(w, i));
    dem__restart(w, i);
    dem__book_motion(w, -dem__rotational(w, r->first));
    const dem_vec spin = dem__spin_of(r->turn, r->moments, r->momentum);
    r->turn = dem__turns(q, dem__given_frame(w, i, r));
    w->engine->bodies.calls->set_motion(w, r, r->v, spin);
    dem__book_motion(w, dem__rotational(w, r->first));
    if (!w->touching[i]) dem__free_acceleration(w, i); /* the arms of loads and links have changed */
    dem__end_change(w, dem__pieces_of(w, i));
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    return DEM_OK;
}
