/* The paper's force on a sphere, for comparison: shear over a layer of one voxel, no pressure. */
#pragma once
#include "spheres.h"

/* ==== >>shear ==== */

/* Computes the velocity at a point between nodes, trilinearly. Solid nodes have the velocity of the sphere that owns
   them. */
static inline void filtration__velocity_at(const filtration__lattice *l, const double at[3], double u[3]) {
    int base[3], mirrored;
    double part[3];
    for (int a = 0; a < 3; a++) base[a] = (int)floor(at[a]), part[a] = at[a] - base[a];
    u[0] = u[1] = u[2] = 0.0;
    for (int corner = 0; corner < 8; corner++) {
        int p[3];
        double weight = 1.0, v[3] = {0, 0, 0};
        for (int a = 0; a < 3; a++) {
            int up = corner >> a & 1;
            p[a] = base[a] + up;
            weight *= up ? part[a] : 1.0 - part[a];
        }
        double d[3] = {(double)p[0], (double)p[1], (double)p[2]};
        if (!filtration__inside(l, p, &mirrored)) continue;
        int32_t owner = l->owner[filtration__node(l, p[0], p[1], p[2])];
        if (owner == FILTRATION__FLUID) {
            filtration__moments(l, p[0], p[1], p[2], v);
            for (int a = 0; a < 3; a++) v[a] *= (mirrored >> a & 1) ? -1.0 : 1.0;
        } else if (owner >= 0) {
            for (int a = 0; a < 3; a++) d[a] -= l->balls[owner].centre[a];
            filtration__surface_velocity(&l->balls[owner], d, v);
        }
        for (int a = 0; a < 3; a++) u[a] += weight * v[a];
    }
}

/* Returns whether a point of a surface lies in the box; beyond a mirror the image carries the force. */
static inline int filtration__in_box(const filtration__lattice *l, const double centre[3], const double d[3]) {
    const int n[3] = {l->nx, l->ny, l->nz};
    for (int a = 0; a < 3; a++) {
        const double x = centre[a] + d[a];
        if ((x < -0.5 || x > n[a] - 0.5) && !filtration__repeats(l, a)) return 0;
    }
    return 1;
}

/* (9) Computes F = mu / dx * integral of the tangential relative velocity one voxel from the surface, as far as it lies
   in the box. Points are spread evenly by a golden spiral, about one on a voxel's face. */
static inline void filtration__shear_force(const filtration__lattice *l, double viscosity, filtration__ball *b) {
    int points = (int)(12.566370614359172 * b->radius * b->radius) + 64;
    double area = 12.566370614359172 * b->radius * b->radius / points, cosine = 1.0, sine = 0.0;
    for (int k = 0; k < points; k++) {
        double nz = 1.0 - (2.0 * k + 1.0) / points, rim = sqrt(1.0 - nz * nz), n[3] = {rim * cosine, rim * sine, nz},
               d[3], at[3], u[3], w[3];
        const double turn = -0.73736887807831963 * cosine - 0.67549029426152364 * sine; /* by the golden angle */
        sine = -0.73736887807831963 * sine + 0.67549029426152364 * cosine;
        cosine = turn;
        for (int a = 0; a < 3; a++) d[a] = n[a] * b->radius, at[a] = b->centre[a] + n[a] * (b->radius + 1.0);
        if (!filtration__in_box(l, b->centre, d)) continue;
        filtration__velocity_at(l, at, u);
        filtration__surface_velocity(b, d, w);
        double along = 0.0, f[3];
        for (int a = 0; a < 3; a++) u[a] -= w[a], along += u[a] * n[a];
        for (int a = 0; a < 3; a++) f[a] = viscosity * area * (u[a] - along * n[a]), b->force[0][a] += f[a];
        b->torque[0][0] += d[1] * f[2] - d[2] * f[1];
        b->torque[0][1] += d[2] * f[0] - d[0] * f[2];
        b->torque[0][2] += d[0] * f[1] - d[1] * f[0];
    }
}

static inline void filtration__shear_forces(const filtration_fluid *fluid) {
    filtration__lattice *l = fluid->lattice;
    for (ptrdiff_t n = 0; n < l->ball_count; n++) {
        filtration__ball *b = &l->balls[n];
        if (!(b->radius > 0.0)) continue;
        memset(b->force[0], 0, sizeof b->force[0]);
        memset(b->torque[0], 0, sizeof b->torque[0]);
        filtration__shear_force(l, (fluid->def.tau - 0.5) / 3.0, b);
    }
}
