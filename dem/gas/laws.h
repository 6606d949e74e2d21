/* Laws of drag: pure functions of scalars. */
#pragma once
#include "../base/vectors.h"

/* A law of drag. Returns the drag coefficient times the Reynolds number, c_D Re [-], for a particle among others. Re =
   density porosity |slip| d/viscosity, where d is the diameter of the sphere of equal volume, and slip the velocity of
   the gas between the particles minus that of the particle. Apart from the pressure gradient, the force is (pi/8)
   viscosity d (c_D Re) slip, which is finite and right at rest, too. porosity: 0 < .. <= 1. NaN for Re < 0 or another
   porosity. */
typedef double (*dem_drag_fn)(double reynolds, double porosity, const dem_gas *gas);

/* Returns x^power of x > 0. */
DEM_INLINE double dem__drag_power(double x, double power) { return riddle_exp(power * riddle_log(x)); }
DEM_INLINE int dem__is_drag(double reynolds, double porosity) {
    return reynolds >= 0.0 && porosity > 0.0 && porosity <= 1.0;
}

/* Returns the exponent chi of the porosity (Di Felice 1994). reynolds: at the superficial slip [-] >= 0. */
DEM_INLINE double dem_di_felice(double reynolds) {
    if (!(reynolds >= 0.0)) return (double)NAN;
    const double off = 1.5 - riddle_log(reynolds) / 2.302585092994045684; /* infinite at rest, where chi is 3.7 */
    return reynolds > 0.0 ? 3.7 - 0.65 * riddle_exp(-0.5 * off * off) : 3.7;
}
/* Returns the factor by which other particles raise c_D Re of a single one (Di Felice 1994): porosity^(1 - chi), for
   c_D Re at the superficial slip and a force that acts on the slip between the particles; 1 alone. Multiply a law for
   single particles by it. */
DEM_INLINE double dem_hindrance_di_felice(double reynolds, double porosity) {
    if (!dem__is_drag(reynolds, porosity)) return (double)NAN;
    return porosity < 1.0 ? dem__drag_power(porosity, 1.0 - dem_di_felice(reynolds)) : 1.0;
}

/* Returns c_D Re of a single sphere by Schiller & Naumann 1933; above Re = 1000 by Newton's 0.44. */
DEM_INLINE double dem__drag_of_sphere(double reynolds) {
    if (reynolds > 1000.0) return 0.44 * reynolds;
    return reynolds > 0.0 ? 24.0 + 3.6 * dem__drag_power(reynolds, 0.687) : 24.0;
}

/* Returns c_D Re by Stokes 1851; among other particles times Di Felice's factor. */
DEM_INLINE double dem_drag_stokes(double reynolds, double porosity, const dem_gas *gas) {
    (void)gas;
    return 24.0 * dem_hindrance_di_felice(reynolds, porosity);
}

/* Returns c_D Re of spheres by Schiller & Naumann 1933, above Re = 1000 by Newton's 0.44; among other particles times
   Di Felice's factor. */
DEM_INLINE double dem_drag_schiller_naumann(double reynolds, double porosity, const dem_gas *gas) {
    (void)gas;
    const double hindrance = dem_hindrance_di_felice(reynolds, porosity); /* NaN outside the domain */
    return dem__drag_of_sphere(reynolds) * hindrance;
}

/* How a law sees the shape of a body at a point of a force field; gas/view.h fills it. */
typedef struct dem__seen {
    void (*find)(const struct dem__seen *s, dem_vec flow, double psi[3]);
    const dem_world *world;
    ptrdiff_t first; /* particle of the body */
    double tau;      /* time of the point after the body's origin step [s] */
} dem__seen;

/* Finds the sphericities of the particle at a point of a force field in a flow along `flow`, of any length: sphericity,
   crosswise and lengthwise sphericity (see dem_shape_of_drag) [-]; 1, 1, 1 for a sphere. For laws of your own. */
DEM_INLINE void dem_sphericities(const dem_force_point *at, dem_vec flow, double psi[3]) {
    psi[0] = psi[1] = psi[2] = 1.0;
    if (at->body__) at->body__->find(at->body__, flow, psi);
}
/* Finds the same for a law of drag, from its argument `gas`: of the particle whose drag is asked for, as the gas flows
   about it; all three the sphericity with DEM_DRAG_BY_SPHERICITY, 1 with DEM_DRAG_SHARED. */
DEM_INLINE void dem_gas_sphericities(const dem_gas *gas, double psi[3]) {
    psi[0] = psi[1] = psi[2] = 1.0;
    if (gas->point__) dem_sphericities(gas->point__, gas->flow__, psi);
    if (gas->bodies == DEM_DRAG_BY_SPHERICITY) psi[1] = psi[2] = psi[0];
}

/* Returns c_D Re by Hoelzer & Sommerfeld 2008, eq. 9, with the shape of the body (dem_gas.bodies), or gas->shape, which
   dem_shape_of_drag() sets; among other particles times Di Felice's factor. */
DEM_INLINE double dem_drag_hoelzer_sommerfeld(double reynolds, double porosity, const dem_gas *gas) {
    double psi[3], shape[3] = {gas->shape[0], gas->shape[1], gas->shape[2]};
    if (gas->point__) {
        dem_gas_sphericities(gas, psi);
        dem_shape_of_drag(psi[0], psi[1], psi[2], shape);
    }
    const double alone = shape[0] + shape[1] * sqrt(reynolds) + shape[2] * reynolds;
    return alone * dem_hindrance_di_felice(reynolds, porosity);
}

/* Returns c_D Re of spheres by Gidaspow 1994: below a porosity of 0.8 by Ergun 1952, from 0.8 on by Wen & Yu 1966. It
   jumps there. */
DEM_INLINE double dem_drag_gidaspow(double reynolds, double porosity, const dem_gas *gas) {
    (void)gas;
    if (!dem__is_drag(reynolds, porosity)) return (double)NAN;
    if (porosity < 0.8) return (200.0 * (1.0 - porosity) + 7.0 / 3.0 * reynolds) / porosity;
    const double alone = dem__drag_of_sphere(reynolds);
    return porosity < 1.0 ? alone * dem__drag_power(porosity, -2.65) : alone;
}

/* Returns c_D Re of spheres by Beetstra, van der Hoef & Kuipers 2007, eq. 16, from lattice-Boltzmann simulations with
   porosities of 0.4 and more, Re up to 1000. */
DEM_INLINE double dem_drag_beetstra(double reynolds, double porosity, const dem_gas *gas) {
    (void)gas;
    if (!dem__is_drag(reynolds, porosity)) return (double)NAN;
    const double solid = 1.0 - porosity, square = porosity * porosity;
    /* divided by 3 pi viscosity d (superficial slip) */
    double force = 10.0 * solid / square + square * (1.0 + 1.5 * sqrt(solid));
    if (reynolds > 0.0) {
        const double ten = 2.302585092994045684, log_re = riddle_log(reynolds);
        const double sum = 1.0 / porosity + 3.0 * porosity * solid + 8.4 * riddle_exp(-0.343 * log_re);
        const double fade = 1.0 + riddle_exp(3.0 * ten * solid - 0.5 * (1.0 + 4.0 * solid) * log_re);
        force += 0.413 / 24.0 * reynolds / square * sum / fade;
    }
    return 24.0 * porosity * force;
}

/* Returns c_D Re of spheres by Hill, Koch & Ladd 2001 (Koch & Hill 2001): F0 + F3 Re/2, from lattice-Boltzmann
   simulations with porosities of 0.36 and more, Re up to 240. Their F contains the part of the pressure gradient, 1 -
   porosity of it. In dilute gas the law is right only at small Re. */
DEM_INLINE double dem_drag_koch_hill(double reynolds, double porosity, const dem_gas *gas) {
    (void)gas;
    if (!dem__is_drag(reynolds, porosity)) return (double)NAN;
    const double solid = 1.0 - porosity, square = porosity * porosity;
    const double logarithm = solid > 0.0 ? 135.0 / 64.0 * solid * riddle_log(solid) : 0.0;
    const double slow = solid < 0.4 ? (1.0 + 3.0 * sqrt(0.5 * solid) + logarithm + 16.14 * solid) /
                                          (1.0 + solid * (0.681 + solid * (-8.48 + solid * 8.16)))
                                    : 10.0 * solid / (square * porosity);
    const double fast = 0.0673 + 0.212 * solid + 0.0232 / (square * square * porosity);
    return 24.0 * square * (slow + 0.5 * fast * reynolds);
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
/* Returns v turned by the frame's angle, or turned back with sign -1. */
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

/* Returns the force of a gas on a particle [N]: drag (NULL: none), pressure gradient, buoyancy; 0 beyond the grid. */
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
    double coefficient = 0.0;
    if (drag && at->body__ && gas->bodies != DEM_DRAG_SHARED) {
        dem_gas own = *gas;
        own.point__ = at, own.flow__ = slip;
        coefficient = drag(reynolds, porosity, &own);
    } else if (drag) coefficient = drag(reynolds, porosity, gas);
    dem_vec force = dem__scale(RIDDLE_PI / 8.0 * gas->viscosity * d * coefficient, slip);
    if (gas->pressure_gradient)
        force = dem__plus(force, -volume, dem__gas_vector(gas, &f, gas->pressure_gradient, &cell));
    return gas->buoyancy ? dem__plus(force, -gas->density * volume, at->gravity) : force;
}

/* Returns how a component of values at nodes changes along an axis of the grid, per cell. */
DEM_INLINE double dem__gas_slope(const double *values, const dem__gas_cell *cell, int of, int along) {
    double sum = 0.0;
    for (int corner = 0; corner < 8; corner++) {
        ptrdiff_t node = cell->first;
        double weight = corner >> along & 1 ? 1.0 : -1.0;
        for (int a = 0; a < 3; a++) {
            node += corner >> a & 1 ? cell->next[a] : 0;
            if (a != along) weight *= corner >> a & 1 ? cell->part[a] : 1.0 - cell->part[a];
        }
        sum += weight * values[node * 3 + of];
    }
    return sum;
}
/* Returns the curl of the gas's velocity in its frame, at a place of the grid. */
DEM_INLINE dem_vec dem__gas_curl(const dem_gas *gas, const dem__gas_cell *cell) {
    double curl[3];
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        const double across = (double)(gas->n[b] - 1) / (dem_axis(gas->high, b) - dem_axis(gas->low, b)),
                     up = (double)(gas->n[c] - 1) / (dem_axis(gas->high, c) - dem_axis(gas->low, c));
        curl[a] = across * dem__gas_slope(gas->velocity, cell, c, b) - up * dem__gas_slope(gas->velocity, cell, b, c);
    }
    return dem_vec3(curl[0], curl[1], curl[2]);
}

/* Returns the coefficient c of the torque -c (spin - spin of the gas) on a sphere of the particle's volume [N m s]: pi
   viscosity d^3 up to Re = density d^2 spin/viscosity = 32 (Stokes), above that by Dennis, Singh & Ingham 1980; 0
   beyond the grid. The gas turns with its frame, and with half the curl of its velocity. *spin: in, of the particle
   [rad/s]; out, relative to the gas. */
DEM_INLINE double dem__gas_turning(const dem_force_point *at, dem_vec *spin) {
    const dem_gas *gas = (const dem_gas *)at->user;
    const dem__gas_frame f = dem__gas_frame_at(gas, at->time);
    const double d = 2.0 * at->radius;
    dem_vec place = dem__sub(at->position, f.centre);
    dem__gas_cell cell;
    if (gas->spin != 0.0) place = dem__turned(gas, &f, place, -1.0);
    if (!dem__gas_cell_of(gas, dem__add(gas->centre, place), &cell)) return 0.0;
    *spin = dem__plus(*spin, -gas->spin, gas->axis);
    if (gas->velocity) *spin = dem__plus(*spin, -0.5, dem__turned(gas, &f, dem__gas_curl(gas, &cell), 1.0));
    const double reynolds = gas->density * d * d * dem__length(*spin) / gas->viscosity;
    const double over = (12.9 * sqrt(reynolds) + 128.4) / (64.0 * RIDDLE_PI); /* over Stokes's torque */
    return RIDDLE_PI * gas->viscosity * d * d * d * (over > 1.0 ? over : 1.0);
}

/* Makes the kernel of a force field from a law of drag in a gas: DEM_GAS(name, dem_drag_schiller_naumann), or a law of
   your own. */
#define DEM_GAS(name, drag)                                                                                            \
    DEM_INLINE dem_vec name##_force(const dem_force_point *at) {                                                       \
        return dem_gas_force(at, (const dem_gas *)at->user, drag);                                                     \
    }                                                                                                                  \
    DEM__FIELD(name, name##_force, dem__gas_turning)
