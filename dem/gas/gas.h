/* A gas around the particles: definition, frame, porosity. Reads the world; writes the caller's structures. */
#pragma once
#include "laws.h"
#include "field.h"

DEM_API dem_gas dem_default_gas(void) {
    dem_gas gas;
    memset(&gas, 0, sizeof gas);
    gas.density = 1.2;
    gas.viscosity = 1.81e-5;
    gas.shape[0] = 24.0, gas.shape[1] = 3.0, gas.shape[2] = 0.42;
    gas.low = dem_vec3(-HUGE_VAL, -HUGE_VAL, -HUGE_VAL);
    gas.high = dem_vec3(HUGE_VAL, HUGE_VAL, HUGE_VAL);
    gas.axis = dem_vec3(0.0, 0.0, 1.0);
    return gas;
}

static inline int dem__is_grid(const dem_gas *gas) {
    double number = 1.0;
    for (int a = 0; a < 3; a++) {
        if (gas->n[a] < 2 || !dem__positive(dem_axis(gas->high, a) - dem_axis(gas->low, a))) return 0;
        number *= gas->n[a];
    }
    return number < 1073741824.0;
}

/* Returns the name of the first bad field, or NULL. */
DEM__STATIC const char *dem__bad_gas(const dem_gas *gas) {
    if (!gas) return "gas";
    if (!dem__positive(gas->density)) return "density";
    if (!dem__positive(gas->viscosity)) return "viscosity";
    if (gas->bodies < DEM_DRAG_BY_ORIENTATION || gas->bodies > DEM_DRAG_SHARED) return "bodies";
    for (int k = 0; k < 3; k++) {
        if (!dem__not_negative(gas->shape[k])) return "shape";
        if (!(dem_axis(gas->high, k) > dem_axis(gas->low, k))) return "high";
    }
    if ((gas->velocity || gas->pressure_gradient || gas->porosity) && !dem__is_grid(gas)) return "n";
    if (!dem__finite_vec(gas->centre)) return "centre";
    if (!dem__finite_vec(gas->axis) || !(fabs(dem__length(gas->axis) - 1.0) < 1e-9)) return "axis";
    if (!dem__moderate_vec(gas->drift)) return "drift";
    if (!dem__moderate(gas->spin)) return "spin";
    return dem__finite(gas->start) ? NULL : "start";
}

DEM_API dem_status dem_check_gas(const dem_gas *gas, const char **field) {
    const char *bad = dem__bad_gas(gas);
    if (field) *field = bad;
    return bad ? DEM_BAD_DEFINITION : DEM_OK;
}

DEM_API dem_force_field dem_gas_field(dem_field_fn kernel, const dem_gas *gas) {
    dem_force_field field = dem_default_force_field(kernel, gas);
    for (int a = 0; gas && a < 3; a++) {
        const double half =
            0.5 * (dem_axis(gas->high, a) - dem_axis(gas->low, a)) / (gas->n[a] > 1 ? gas->n[a] - 1 : 1);
        field.length = half < field.length ? half : field.length;
    }
    return field;
}

DEM_API dem_status dem_attach_gas(dem_gas *gas, const dem_world *world, int wall) {
    if (!gas || !world || wall < 0 || wall >= world->walls) return DEM_BAD_ARGUMENT;
    const dem_wall *w = &world->wall[wall];
    if (w->asked.drive != DEM_KINEMATIC || w->asked.frequency != 0.0) return DEM_BAD_ARGUMENT;
    gas->start = world->time;
    gas->drift = w->asked.drift;
    gas->spin = w->spin;
    if (w->spin == 0.0) return DEM_OK;
    gas->axis = w->spin_axis;
    gas->centre = dem__plus(w->asked.spin_centre, world->time - w->asked.motion_start, w->asked.drift);
    return DEM_OK;
}

DEM_API dem_vec dem_gas_velocity(const dem_gas *gas, dem_vec position, double time) {
    const dem_vec none = dem_vec3((double)NAN, (double)NAN, (double)NAN);
    dem__gas_cell cell;
    if (dem__bad_gas(gas)) return none;
    const dem__gas_frame f = dem__gas_frame_at(gas, time);
    const dem_vec place = dem__turned(gas, &f, dem__sub(position, f.centre), -1.0);
    return dem__gas_cell_of(gas, dem__add(gas->centre, place), &cell) ? dem__gas_speed(gas, &f, &cell, position) : none;
}

DEM_API dem_status dem_gas_porosity(const dem_world *world, const dem_gas *gas, double *porosity) {
    const dem_world *w = world;
    if (!w || !w->def.allocator.fn || !porosity || dem__bad_gas(gas) || !dem__is_grid(gas)) return DEM_BAD_ARGUMENT;
    const ptrdiff_t row = gas->n[0], layer = row * gas->n[1], all = layer * gas->n[2];
    const dem__gas_frame f = dem__gas_frame_at(gas, w->time);
    double size = 1.0;
    for (int a = 0; a < 3; a++) size *= (dem_axis(gas->high, a) - dem_axis(gas->low, a)) / (gas->n[a] - 1);
    for (ptrdiff_t k = 0; k < all; k++) porosity[k] = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dem__gas_cell cell;
        const double d = dem__diameter_of(w, i);
        const dem_vec place = dem__turned(gas, &f, dem__sub(dem__centre_now(w, i), f.centre), -1.0);
        if (w->alive[i] <= 0 || !dem__leads(w, i) || !dem__gas_cell_of(gas, dem__add(gas->centre, place), &cell))
            continue;
        for (int corner = 0; corner < 8; corner++) {
            ptrdiff_t node = cell.first;
            double share = RIDDLE_PI / 6.0 * d * d * d;
            for (int a = 0; a < 3; a++) {
                node += corner >> a & 1 ? cell.next[a] : 0;
                share *= corner >> a & 1 ? cell.part[a] : 1.0 - cell.part[a];
            }
            porosity[node] += share;
        }
    }
    for (ptrdiff_t k = 0; k < all; k++) {
        const ptrdiff_t at[3] = {k % row, k / row % gas->n[1], k / layer};
        double room = size; /* volume of the node; half a cell less at a face of the grid */
        for (int a = 0; a < 3; a++) room *= at[a] == 0 || at[a] == gas->n[a] - 1 ? 0.5 : 1.0;
        const double left = 1.0 - porosity[k] / room;
        porosity[k] = left > 0.2 ? left : 0.2;
    }
    return DEM_OK;
}

DEM_API void dem_shape_of_drag(double sphericity, double crosswise, double lengthwise, double shape[3]) {
    const double psi[3] = {sphericity, crosswise, lengthwise};
    if (!shape) return;
    for (int k = 0; k < 3; k++) shape[k] = (double)NAN;
    for (int k = 0; k < 3; k++) {
        if (!(psi[k] > 0.0 && psi[k] <= (k == 0 ? 1.0 : 100.0))) return;
    }
    const double flat = -riddle_log(sphericity) / 2.302585092994045684; /* -log10 */
    shape[0] = 8.0 / sqrt(lengthwise) + 16.0 / sqrt(sphericity);
    shape[1] = 3.0 / sqrt(sphericity * sqrt(sphericity));
    shape[2] = 0.42 / crosswise;
    if (flat > 0.0) shape[2] *= riddle_exp(2.302585092994045684 * 0.4 * riddle_exp(0.2 * riddle_log(flat)));
}
