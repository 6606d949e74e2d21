/* Laws of drag: pure functions of scalars. */
#pragma once
#include "../base/vectors.h"

/* A law of drag: returns the drag coefficient times the Reynolds number, c_D Re [-], for Re = density |slip|
   d/viscosity, d the diameter of the sphere of equal volume. The force is (pi/8) viscosity d (c_D Re) slip: finite, and
   right, at rest. NaN for Re < 0. */
typedef double (*dem_drag_fn)(double reynolds, const dem_gas *gas);

/* Returns c_D Re by Stokes 1851. */
DEM_INLINE double dem_drag_stokes(double reynolds, const dem_gas *gas) {
    (void)gas;
    return reynolds >= 0.0 ? 24.0 : (double)NAN;
}

/* Returns c_D Re by Schiller & Naumann 1933, for spheres; beyond Re = 1000 by Newton's 0.44. */
DEM_INLINE double dem_drag_schiller_naumann(double reynolds, const dem_gas *gas) {
    (void)gas;
    if (!(reynolds >= 0.0)) return (double)NAN;
    if (reynolds > 1000.0) return 0.44 * reynolds;
    return reynolds > 0.0 ? 24.0 + 3.6 * riddle_exp(0.687 * riddle_log(reynolds)) : 24.0;
}

/* Returns c_D Re by Hoelzer & Sommerfeld 2008, with gas->shape, which dem_shape_of_drag() sets. */
DEM_INLINE double dem_drag_hoelzer_sommerfeld(double reynolds, const dem_gas *gas) {
    return gas->shape[0] + gas->shape[1] * sqrt(reynolds) + gas->shape[2] * reynolds;
}

/* Returns the exponent chi of the porosity (Di Felice 1994). The drag on a particle among others is that on a single
   one, both at the superficial slip, times porosity^-chi. reynolds: at the superficial slip [-] >= 0. */
DEM_INLINE double dem_di_felice(double reynolds) {
    if (!(reynolds >= 0.0)) return (double)NAN;
    const double off = 1.5 - riddle_log(reynolds) / 2.302585092994045684; /* infinite at rest, where chi is 3.7 */
    return reynolds > 0.0 ? 3.7 - 0.65 * riddle_exp(-0.5 * off * off) : 3.7;
}

/* The frame of a gas at a time: its centre and its rotation. */
typedef struct dem__gas_frame {
    dem_vec centre;
    double s, c; /* sine and cosine of the angle of rotation */
} dem__gas_frame;
DEM_INLINE dem__gas_frame dem__gas_frame_at(const dem_gas *gas, double time) {
    const double t = time - gas->start;
    dem__gas_frame f;
    f.centre = dem__plus(gas->centre, t, gas->drift);
    f.s = 0.0, f.c = 1.0;
    if (gas->spin != 0.0) {
        const double turns = gas->spin * t / (2.0 * RIDDLE_PI), angle = 2.0 * RIDDLE_PI * (turns - floor(turns));
        f.s = riddle_sin(angle), f.c = riddle_cos(angle);
    }
    return f;
}
/* Returns v turned by the frame's angle, or with sign -1 turned back. */
DEM_INLINE dem_vec dem__turned(const dem_gas *gas, const dem__gas_frame *f, dem_vec v, double sign) {
    const double along = (1.0 - f->c) * dem__dot(gas->axis, v);
    return dem__plus(dem__plus(dem__scale(f->c, v), sign * f->s, dem__cross(gas->axis, v)), along, gas->axis);
}

/* A place of the grid: the node below it, and its distance from that node in cells. */
typedef struct dem__gas_cell {
    ptrdiff_t first, next[3];
    double part[3];
} dem__gas_cell;
/* Finds the cell of a place in the frame. Returns 0 beyond the grid. */
DEM_INLINE int dem__gas_cell_of(const dem_gas *gas, dem_vec at, dem__gas_cell *cell) {
    ptrdiff_t stride = 1;
    cell->first = 0;
    for (int a = 0; a < 3; a++) {
        const double low = dem_axis(gas->low, a), high = dem_axis(gas->high, a), x = dem_axis(at, a);
        cell->next[a] = 0, cell->part[a] = 0.0;
        if (!(x >= low && x <= high)) return 0;
        if (gas->n[a] < 2) continue;
        const double u = (x - low) / (high - low) * (gas->n[a] - 1);
        int k = (int)u;
        k = k > gas->n[a] - 2 ? gas->n[a] - 2 : k;
        cell->first += k * stride;
        cell->next[a] = stride;
        cell->part[a] = u - k;
        stride *= gas->n[a];
    }
    return 1;
}
/* Returns component `of` of `size` at a place, interpolated trilinearly. */
DEM_INLINE double dem__gas_value(const double *values, const dem__gas_cell *cell, int size, int of) {
    double sum = 0.0;
    for (int corner = 0; corner < 8; corner++) {
        ptrdiff_t node = cell->first;
        double weight = 1.0;
        for (int a = 0; a < 3; a++) {
            node += corner >> a & 1 ? cell->next[a] : 0;
            weight *= corner >> a & 1 ? cell->part[a] : 1.0 - cell->part[a];
        }
        sum += weight * values[node * size + of];
    }
    return sum;
}
DEM_INLINE dem_vec dem__gas_vector(const dem_gas *gas, const dem__gas_frame *f, const double *values,
                                   const dem__gas_cell *cell) {
    return dem__turned(gas, f,
                       dem_vec3(dem__gas_value(values, cell, 3, 0), dem__gas_value(values, cell, 3, 1),
                                dem__gas_value(values, cell, 3, 2)),
                       1.0);
}

/* Returns the velocity of the gas in the world at x, which lies in a cell. */
DEM_INLINE dem_vec dem__gas_speed(const dem_gas *gas, const dem__gas_frame *f, const dem__gas_cell *cell, dem_vec x) {
    dem_vec u = gas->drift;
    if (gas->spin != 0.0) u = dem__plus(u, gas->spin, dem__cross(gas->axis, dem__sub(x, f->centre)));
    return gas->velocity ? dem__add(u, dem__gas_vector(gas, f, gas->velocity, cell)) : u;
}

/* Returns the force of a gas on a particle [N]: drag, alone or among others, pressure gradient, buoyancy; 0 beyond the
   grid. */
DEM_INLINE dem_vec dem_gas_force(const dem_force_point *at, const dem_gas *gas, dem_drag_fn drag) {
    const dem__gas_frame f = dem__gas_frame_at(gas, at->time);
    const double d = 2.0 * at->radius, volume = RIDDLE_PI / 6.0 * d * d * d;
    dem_vec place = dem__sub(at->position, f.centre);
    dem__gas_cell cell;
    if (gas->spin != 0.0) place = dem__turned(gas, &f, place, -1.0);
    if (!dem__gas_cell_of(gas, dem__add(gas->centre, place), &cell)) return dem_vec3(0.0, 0.0, 0.0);
    const dem_vec slip = dem__sub(dem__gas_speed(gas, &f, &cell, at->position), at->velocity);
    const double porosity = gas->porosity ? dem__gas_value(gas->porosity, &cell, 1, 0) : 1.0;
    const double reynolds = gas->density * porosity * dem__length(slip) * d / gas->viscosity;
    double factor = RIDDLE_PI / 8.0 * gas->viscosity * d * drag(reynolds, gas);
    if (porosity < 1.0) factor *= riddle_exp((1.0 - dem_di_felice(reynolds)) * riddle_log(porosity));
    dem_vec force = dem__scale(factor, slip);
    if (gas->pressure_gradient)
        force = dem__plus(force, -volume, dem__gas_vector(gas, &f, gas->pressure_gradient, &cell));
    return gas->buoyancy ? dem__plus(force, -gas->density * volume, at->gravity) : force;
}

/* Makes the kernel of a force field of drag in a gas from a law of drag: DEM_GAS(name, dem_drag_schiller_naumann), or
   one of yours. */
#define DEM_GAS(name, drag)                                                                                            \
    DEM_INLINE dem_vec name##_force(const dem_force_point *at) {                                                       \
        return dem_gas_force(at, (const dem_gas *)at->user, drag);                                                     \
    }                                                                                                                  \
    DEM_FORCE_FIELD(name, name##_force)
