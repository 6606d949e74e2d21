/* Reads and changes the flow between steps: samples, fields, sums, another time step, a flow to start from. */
#pragma once
#include "fluid.h"

/* ==== >>flow ==== */

FILTRATION_API filtration_status filtration_fluid_at(const filtration_fluid *fluid, int x, int y, int z,
                                                     filtration_sample *sample) {
    const filtration__lattice *l = fluid ? fluid->lattice : NULL;
    if (!l || !sample || x < 0 || y < 0 || z < 0 || x >= l->nx || y >= l->ny || z >= l->nz)
        return FILTRATION_BAD_ARGUMENT;
    memset(sample, 0, sizeof *sample);
    sample->owner = l->owner[filtration__node(l, x, y, z)];
    if (sample->owner != FILTRATION__FLUID) return FILTRATION_OK;
    sample->pressure = filtration__moments(l, x, y, z, sample->velocity) * l->to_pressure / 3.0;
    for (int a = 0; a < 3; a++) sample->velocity[a] *= l->to_velocity;
    return FILTRATION_OK;
}

FILTRATION_API void filtration_fluid_fields(const filtration_fluid *fluid, float *velocity, float *pressure,
                                            int32_t *owner) {
    const filtration__lattice *l = fluid ? fluid->lattice : NULL;
    filtration_sample s;
    for (int z = 0; l && z < l->nz; z++)
        for (int y = 0; y < l->ny; y++)
            for (int x = 0; x < l->nx; x++) {
                ptrdiff_t n = filtration__node(l, x, y, z);
                (void)filtration_fluid_at(fluid, x, y, z, &s);
                for (int a = 0; velocity && a < 3; a++) velocity[3 * n + a] = (float)s.velocity[a];
                if (pressure) pressure[n] = (float)s.pressure;
                if (owner) owner[n] = s.owner;
            }
}

/* Sums over the fluid nodes of a part of the box, in lattice units: deviation of density, momentum, number of nodes,
   largest squared speed. */
static inline void filtration__sum(const filtration__lattice *l, const int low[3], const int high[3], double sum[6]) {
    for (int k = 0; k < 6; k++) sum[k] = 0.0;
    for (int z = low[2]; z < high[2]; z++)
        for (int y = low[1]; y < high[1]; y++) {
            double row[4] = {0, 0, 0, 0};
            for (int x = low[0]; x < high[0]; x++) {
                double u[3];
                if (l->owner[filtration__node(l, x, y, z)] != FILTRATION__FLUID) continue;
                row[0] += filtration__moments(l, x, y, z, u);
                for (int a = 0; a < 3; a++) row[a + 1] += u[a];
                double uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
                sum[4] += 1.0;
                if (uu > sum[5]) sum[5] = uu;
            }
            for (int k = 0; k < 4; k++) sum[k] += row[k];
        }
}

static inline void filtration__sum_all(const filtration__lattice *l, double sum[6]) {
    const int low[3] = {0, 0, 0}, high[3] = {l->nx, l->ny, l->nz};
    filtration__sum(l, low, high, sum);
}

FILTRATION_API void filtration_fluid_mean_velocity(const filtration_fluid *fluid, double velocity[3]) {
    double sum[6];
    for (int a = 0; a < 3 && velocity; a++) velocity[a] = (double)NAN;
    if (!fluid || !fluid->lattice || !velocity) return;
    filtration__sum_all(fluid->lattice, sum);
    for (int a = 0; a < 3; a++)
        velocity[a] = sum[a + 1] * fluid->lattice->to_velocity / (double)filtration__nodes(fluid->lattice);
}

FILTRATION_API double filtration_fluid_flux(const filtration_fluid *fluid, int axis, int slab) {
    if (!fluid || !fluid->lattice) return (double)NAN;
    const filtration__lattice *l = fluid->lattice;
    int low[3] = {0, 0, 0}, high[3] = {l->nx, l->ny, l->nz};
    double sum[6];
    if (axis < 0 || axis > 2 || slab < 0 || slab >= high[axis]) return (double)NAN;
    double nodes = (double)filtration__nodes(l) / high[axis];
    low[axis] = slab, high[axis] = slab + 1;
    filtration__sum(l, low, high, sum);
    return sum[axis + 1] * l->to_velocity / nodes;
}

FILTRATION_API double filtration_fluid_mass(const filtration_fluid *fluid) {
    if (!fluid || !fluid->lattice) return (double)NAN;
    double sum[6], dx = fluid->def.voxel;
    filtration__sum_all(fluid->lattice, sum);
    return (sum[0] + sum[4]) * fluid->def.density * dx * dx * dx;
}

FILTRATION_API double filtration_fluid_porosity(const filtration_fluid *fluid) {
    if (!fluid || !fluid->lattice) return (double)NAN;
    double fluid_nodes = 0.0;
    size_t nodes = filtration__nodes(fluid->lattice);
    for (size_t k = 0; k < nodes; k++) fluid_nodes += fluid->lattice->owner[k] == FILTRATION__FLUID;
    return fluid_nodes / (double)nodes;
}

FILTRATION_API double filtration_fluid_max_speed(const filtration_fluid *fluid) {
    double sum[6];
    if (!fluid || !fluid->lattice) return (double)NAN;
    filtration__sum_all(fluid->lattice, sum);
    return sqrt(sum[5]) * fluid->lattice->to_velocity;
}

FILTRATION_API void filtration_fluid_solid_force(const filtration_fluid *fluid, double force[3]) {
    for (int a = 0; a < 3 && force; a++) force[a] = (double)NAN;
    if (!fluid || !fluid->lattice || !force) return;
    filtration__solid_force(fluid->lattice, force);
    for (int a = 0; a < 3; a++) force[a] *= fluid->lattice->to_force;
}

/* ---- changes ---- */

/* Adopts a definition, unless it is out of range. */
static inline filtration_status filtration__change(filtration_fluid *fluid, const filtration_fluid_def *def) {
    if (filtration_fluid_check_def(def, NULL) != FILTRATION_OK) return FILTRATION_BAD_ARGUMENT;
    fluid->def = *def;
    filtration__set_units(fluid);
    return FILTRATION_OK;
}

FILTRATION_API filtration_status filtration_fluid_set_body_force(filtration_fluid *fluid, const double force[3]) {
    if (!fluid || !force) return FILTRATION_BAD_ARGUMENT;
    filtration_fluid_def def = fluid->def;
    memcpy(def.body_force, force, sizeof def.body_force);
    return filtration__change(fluid, &def);
}

FILTRATION_API filtration_status filtration_fluid_set_face_pressure(filtration_fluid *fluid, int face,
                                                                    double pressure) {
    if (!fluid) return FILTRATION_BAD_ARGUMENT;
    filtration_fluid_def def = fluid->def;
    if (face < 0 || face > 5 || !fluid->lattice || !fluid->lattice->face[face]->has_pressure)
        return FILTRATION_BAD_ARGUMENT;
    def.face_pressure[face] = pressure;
    return filtration__change(fluid, &def);
}

FILTRATION_API filtration_status filtration_fluid_set_face_velocity(filtration_fluid *fluid, int face,
                                                                    const double velocity[3]) {
    if (!fluid || !velocity) return FILTRATION_BAD_ARGUMENT;
    filtration_fluid_def def = fluid->def;
    if (face < 0 || face > 5 || !fluid->lattice || !fluid->lattice->face[face]->has_velocity)
        return FILTRATION_BAD_ARGUMENT;
    memcpy(def.face_velocity[face], velocity, sizeof def.face_velocity[face]);
    return filtration__change(fluid, &def);
}

/* Computes the new populations of a node. */
typedef struct filtration__new_flow {
    void (*node)(const filtration_fluid *fluid, const struct filtration__new_flow *flow, int x, int y, int z,
                 double h[FILTRATION__Q]);
    /* Factors of a rescaled flow [-]. */
    double speed, stress;
    void (*fn)(void *user, const double point[3], double velocity[3], double *pressure); /* of a flow to start from */
    void *user;
} filtration__new_flow;

/* Gives every fluid node its new populations or, if a number is out of range, none. Returns whether it did. */
static inline int filtration__set_nodes(filtration_fluid *fluid, const filtration__new_flow *flow) {
    filtration__lattice *l = fluid->lattice;
    double h[FILTRATION__Q];
    for (int store = 0; store < 2; store++)
        for (int z = 0; z < l->nz; z++)
            for (int y = 0; y < l->ny; y++)
                for (int x = 0; x < l->nx; x++) {
                    if (l->owner[filtration__node(l, x, y, z)] != FILTRATION__FLUID) continue;
                    flow->node(fluid, flow, x, y, z, h);
                    for (int i = 0; i < l->q; i++) {
                        if (!(fabs(h[i]) < FILTRATION__LARGEST_POPULATION)) return 0;
                        if (store) filtration__put(l, filtration__incoming(l, x, y, z, i), h[i]);
                    }
                }
    return 1;
}

/* Rescales a node: velocity by s, pressure and force by s^2, the non-equilibrium part like a stress: by s and the ratio
   of relaxation times. Before a collision, the momentum lacks half of the force. */
FILTRATION__STATIC void filtration__rescale(const filtration_fluid *fluid, const filtration__new_flow *flow, int x,
                                            int y, int z, double h[FILTRATION__Q]) {
    const filtration__lattice *l = fluid->lattice;
    double u[3], v[3], s = flow->speed, stress = flow->stress, r = filtration__moments(l, x, y, z, u);
    for (int a = 0; a < 3; a++) v[a] = u[a] * s;
    for (int i = 0; i < l->q; i++) {
        double cf = 0.0;
        for (int a = 0; a < 3; a++) cf += l->c[i][a] * l->rates.force[a];
        h[i] = filtration__get(l, filtration__incoming(l, x, y, z, i)) - filtration__equilibrium(l, i, r, u);
        h[i] = filtration__equilibrium(l, i, r * s * s, v) + stress * h[i] + 1.5 * l->w[i] * (stress - s * s) * cf;
    }
}

FILTRATION_API filtration_status filtration_fluid_set_tau(filtration_fluid *fluid, double tau) {
    if (!fluid) return FILTRATION_BAD_ARGUMENT;
    filtration_fluid_def def = fluid->def;
    filtration__lattice *l = fluid->lattice;
    double s = (tau - 0.5) / (def.tau - 0.5);
    const filtration__new_flow flow = {filtration__rescale, s, s * tau / def.tau, NULL, NULL};
    def.tau = tau;
    if (filtration_fluid_check_def(&def, NULL) != FILTRATION_OK || !filtration__set_nodes(fluid, &flow))
        return FILTRATION_BAD_ARGUMENT;
    for (ptrdiff_t n = 0; n < l->ball_count; n++) {
        filtration__ball *b = &l->balls[n];
        b->density *= s * s;
        for (int a = 0; a < 3; a++) {
            b->slope[a] *= s * s;
            for (int k = 0; k < 2; k++) b->force[k][a] *= s * s, b->torque[k][a] *= s * s;
        }
    }
    return filtration__change(fluid, &def);
}

/* Computes a node's equilibrium plus the stress of the velocity's differences over a voxel: -w tau / 3 * (9 c c - 3) :
   grad u to first order. */
FILTRATION__STATIC void filtration__start_node(const filtration_fluid *fluid, const filtration__new_flow *flow, int x,
                                               int y, int z, double h[FILTRATION__Q]) {
    const filtration__lattice *l = fluid->lattice;
    double point[3], u[3] = {0, 0, 0}, p = 0.0, grad[3][3], trace = 0.0, aside = 0.0;
    filtration__point(&fluid->def, x, y, z, point);
    flow->fn(flow->user, point, u, &p);
    for (int b = 0; b < 3; b++) {
        double low[3] = {0, 0, 0}, high[3] = {0, 0, 0}, q[3] = {point[0], point[1], point[2]};
        q[b] = point[b] - 0.5 * fluid->def.voxel;
        flow->fn(flow->user, q, low, &aside);
        q[b] = point[b] + 0.5 * fluid->def.voxel;
        flow->fn(flow->user, q, high, &aside);
        for (int a = 0; a < 3; a++) grad[a][b] = (high[a] - low[a]) / l->to_velocity;
        trace += grad[b][b];
    }
    for (int a = 0; a < 3; a++) u[a] /= l->to_velocity;
    for (int i = 0; i < l->q; i++) {
        double cgc = 0.0, cf = 0.0;
        for (int a = 0; a < 3; a++) {
            cf += l->c[i][a] * l->rates.force[a];
            for (int b = 0; b < 3; b++) cgc += l->c[i][a] * grad[a][b] * l->c[i][b];
        }
        h[i] = filtration__equilibrium(l, i, 3.0 * p / l->to_pressure, u) -
               l->w[i] * (3.0 * fluid->def.tau * (cgc - trace / 3.0) + 1.5 * cf);
    }
}

FILTRATION_API filtration_status filtration_fluid_set_flow(filtration_fluid *fluid,
                                                           void (*fn)(void *user, const double point[3],
                                                                      double velocity[3], double *pressure),
                                                           void *user) {
    filtration__lattice *l = fluid ? fluid->lattice : NULL;
    const filtration__new_flow flow = {filtration__start_node, 1.0, 1.0, fn, user};
    if (!l || !fn || !filtration__set_nodes(fluid, &flow)) return FILTRATION_BAD_ARGUMENT;
    memset(l->slab_active, 1, (size_t)l->nz);
    return FILTRATION_OK;
}

FILTRATION_API filtration_status filtration_fluid_keep_mass(filtration_fluid *fluid) {
    return fluid && fluid->lattice ? filtration__level(fluid) : FILTRATION_BAD_ARGUMENT;
}
