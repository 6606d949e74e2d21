/* Steady flow through the solids in the box. */
#pragma once
#include "flow.h"

/* ==== >>permeability ==== */

/* Returns the steps between two checks: the time in which momentum spreads over a sixteenth of the shortest side, at
   least 20. */
static inline int64_t filtration__interval(const filtration_fluid *fluid) {
    double n = fluid->def.nodes[0];
    for (int a = 1; a < 3; a++)
        if (fluid->def.nodes[a] < n) n = fluid->def.nodes[a];
    double steps = n * n / 16.0 * 3.0 / (fluid->def.tau - 0.5) / 4.0;
    return steps < 20.0 ? 20 : steps > 1e6 ? 1000000 : (int64_t)steps;
}

FILTRATION_API filtration_status filtration_fluid_permeability(filtration_fluid *fluid,
                                                               const filtration_spheres *spheres, int axis,
                                                               double pressure_drop, double tolerance,
                                                               int64_t max_steps,
                                                               filtration_permeability_result *result) {
    if (!fluid || !fluid->lattice || !result || axis < 0 || axis > 2 ||
        !(pressure_drop > 0.0 && pressure_drop < HUGE_VAL))
        return FILTRATION_BAD_ARGUMENT;
    if (!(tolerance >= 0.0 && tolerance < 1.0) || !filtration__repeats(fluid->lattice, axis))
        return FILTRATION_BAD_ARGUMENT;
    memset(result, 0, sizeof *result);
    double length = fluid->def.nodes[axis] * fluid->def.voxel, force[3] = {0, 0, 0}, velocity[3], before = 0.0;
    int64_t start = fluid->steps, interval = filtration__interval(fluid);
    force[axis] = pressure_drop / length;
    const double old[3] = {fluid->def.body_force[0], fluid->def.body_force[1], fluid->def.body_force[2]};
    filtration_status status = filtration_fluid_set_body_force(fluid, force);
    result->pressure_drop = pressure_drop;
    for (result->change = 1.0; status == FILTRATION_OK && result->change > (tolerance > 0.0 ? tolerance : 1e-5);) {
        if (fluid->steps - start >= max_steps) return FILTRATION_NOT_STEADY;
        status = filtration_fluid_run(fluid, interval, spheres);
        /* refused */
        if (status == FILTRATION_BAD_ARGUMENT && fluid->steps == start) filtration_fluid_set_body_force(fluid, old);
        filtration_fluid_mean_velocity(fluid, velocity);
        result->velocity = velocity[axis];
        result->change = velocity[axis] != 0.0 ? fabs(velocity[axis] - before) / fabs(velocity[axis]) : 0.0;
        result->steps = fluid->steps - start;
        before = velocity[axis];
    }
    result->permeability = fluid->def.viscosity * result->velocity * length / pressure_drop;
    result->resistance = pressure_drop / (fluid->def.viscosity * result->velocity);
    result->porosity = filtration_fluid_porosity(fluid);
    result->reynolds = filtration_fluid_max_speed(fluid) * fluid->def.voxel * fluid->def.density / fluid->def.viscosity;
    return status;
}
