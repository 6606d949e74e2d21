/* Getters of bodies: orientation, state. They read a const world. */
#pragma once
#include "../motion/state.h"

DEM_API dem_quaternion dem_orientation(const dem_world *world, ptrdiff_t i) {
    if (!world || i < 0 || i >= world->count)
        return dem__quaternion((double)NAN, dem_vec3((double)NAN, (double)NAN, (double)NAN));
    const dem__rigid *r = dem__rigid_of(world, i);
    if (!r) return dem__quaternion(1.0, dem_vec3(0.0, 0.0, 0.0));
    return dem__turns(dem__body_turn_at(world, i, dem__now(world, i)),
                      dem__opposite_turn(dem__given_frame(world, i, r)));
}

DEM_API dem_body dem_get_body(const dem_world *world, ptrdiff_t i) {
    dem_body body;
    memset(&body, 0, sizeof body);
    body.first = -1;
    if (!world || i < 0 || i >= world->count) return body;
    const dem__rigid *r = dem__rigid_of(world, i);
    const dem__pieces own = dem__pieces_of(world, i);
    const double tau = dem__now(world, i), inertia = dem__inertia(world, i);
    body.first = own.first, body.pieces = own.end - own.first;
    body.mass = world->particle[i].mass;
    body.diameter = dem__diameter_of(world, i);
    body.position = dem__centre_now(world, i), body.velocity = dem__true_drift_at(world, i, tau);
    body.spin = dem__spin_at(world, i, tau), body.orientation = dem_orientation(world, i);
    body.moments = r ? r->moments : dem_vec3(inertia, inertia, inertia);
    body.axes = r ? dem__body_turn_at(world, i, tau) : body.orientation;
    return body;
}
