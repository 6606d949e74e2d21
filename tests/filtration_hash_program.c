/* filtration_hash_program.c: runs four small flows and prints the hash of each, one a line: both precisions, both
   lattices, moving spheres, a cloth, every kind of face. Compiled in several ways by tests/check_filtration: the lines
   must not differ.
   Usage: filtration_hash_program [threads] */
#include <stdio.h>
#include <stdlib.h>

#include "filtration.h"

enum { NODES = 32, SPHERES = 10, STEPS = 41 };

static uint64_t add_bits(uint64_t hash, const void *data, size_t bytes) {
    for (size_t k = 0; k < bytes; k++) hash = (hash ^ ((const unsigned char *)data)[k]) * UINT64_C(0x100000001b3);
    return hash;
}

/* Adds numbers by value, so that the order of bytes in memory does not matter. */
static uint64_t add(uint64_t hash, const double *values, int count) {
    for (int k = 0; k < count; k++) {
        unsigned char bytes[8];
        uint64_t bits;
        memcpy(&bits, &values[k], sizeof bits);
        for (int b = 0; b < 8; b++) bytes[b] = (unsigned char)(bits >> 8 * b);
        hash = add_bits(hash, bytes, sizeof bytes);
    }
    return hash;
}

static uint64_t flow_hash(const filtration_fluid *fluid, uint64_t hash) {
    filtration_sample s;
    for (int z = 0; z < fluid->def.nodes[2]; z++)
        for (int y = 0; y < fluid->def.nodes[1]; y++)
            for (int x = 0; x < fluid->def.nodes[0]; x++) {
                if (filtration_fluid_at(fluid, x, y, z, &s) != FILTRATION_OK) return 0;
                hash = add(add(hash, s.velocity, 3), &s.pressure, 1);
            }
    return hash;
}

static filtration_fluid_def small_box(int threads) {
    filtration_fluid_def def = filtration_fluid_default_def();
    def.nodes[0] = 70; /* not a multiple of a vector */
    def.nodes[1] = def.nodes[2] = NODES;
    def.voxel = 1e-6;
    def.threads = threads;
    def.face[FILTRATION_LOW_Z] = def.face[FILTRATION_HIGH_Z] = FILTRATION_WALL;
    return def;
}

/* Ten spheres that spin and move between a wall at rest and one that moves. */
static uint64_t spheres(filtration_fluid_def def) {
    double centre[3 * SPHERES], velocity[3 * SPHERES], spin[3 * SPHERES], radius[SPHERES], force[3 * SPHERES],
        torque[3 * SPHERES];
    const filtration_spheres all = {SPHERES, centre, velocity, spin, radius, force, torque};
    filtration_fluid fluid;
    def.face_velocity[FILTRATION_HIGH_Z][1] = 0.01;
    for (int n = 0; n < SPHERES; n++) {
        radius[n] = 2.2e-6 + 0.1e-6 * n;
        for (int a = 0; a < 3; a++) {
            centre[3 * n + a] = (a == 2 ? 5.0 + 2.2 * n : 3.0 + (7 * n + 11 * a) % 29) * 1e-6;
            velocity[3 * n + a] = 0.001 * ((n * 5 + a * 3) % 7 - 3);
            spin[3 * n + a] = 300.0 * ((n * 3 + a * 5) % 5 - 2);
        }
    }
    if (filtration_fluid_init(&fluid, &def) != FILTRATION_OK) return 0;
    for (int k = 0; k < STEPS; k++) {
        if (filtration_fluid_step(&fluid, &all) != FILTRATION_OK) return 0;
        for (int n = 0; n < 3 * SPHERES; n++) centre[n] += velocity[n] * fluid.dt * (n % 3 == 2 ? 0.1 : 1.0);
    }
    const uint64_t hash = flow_hash(&fluid, add(add(1, force, 3 * SPHERES), torque, 3 * SPHERES));
    filtration_fluid_free(&fluid);
    return hash;
}

/* A twill between a face at 100 Pa and one at none, or driven by a force along it; the time step changes half way. */
static uint64_t cloth(filtration_fluid_def def, int driven) {
    filtration_cloth twill;
    filtration_fluid fluid;
    if (filtration_cloth_make(&twill, 3.5e-6, 4.5e-6, FILTRATION_TWILL_WEAVE, 16e-6) != FILTRATION_OK) return 0;
    def.nodes[0] = NODES;
    def.solid = filtration_cloth_solid(&twill);
    def.face[FILTRATION_LOW_Z] = def.face[FILTRATION_HIGH_Z] = driven ? FILTRATION_SYMMETRY : FILTRATION_PRESSURE;
    if (driven) def.body_force[0] = 1e5;
    else def.face_pressure[FILTRATION_HIGH_Z] = 100.0;
    if (filtration_fluid_init(&fluid, &def) != FILTRATION_OK) return 0;
    if (filtration_fluid_run(&fluid, STEPS, NULL) != FILTRATION_OK ||
        filtration_fluid_set_tau(&fluid, 0.7) != FILTRATION_OK)
        return 0;
    if (filtration_fluid_run(&fluid, STEPS, NULL) != FILTRATION_OK) return 0;
    const uint64_t hash = flow_hash(&fluid, 1);
    filtration_fluid_free(&fluid);
    return hash;
}

static void say(const char *name, uint64_t hash) {
    printf("%-14s %016llx%s\n", name, (unsigned long long)hash, hash ? "" : " failed");
}

int main(int argc, char **argv) {
    const filtration_fluid_def def = small_box(argc > 1 ? atoi(argv[1]) : 1);
    filtration_fluid_def d = def;
    d.bulk_ratio = 5.0;
    say("spheres double", spheres(d));
    d = def, d.precision = FILTRATION_FLOAT;
    say("spheres float", spheres(d));
    d = def, d.precision = FILTRATION_FLOAT, d.bulk_ratio = 2.0;
    say("cloth float", cloth(d, 0));
    d = def, d.lattice = FILTRATION_D3Q15, d.boundary = FILTRATION_HALF_WAY;
    say("cloth D3Q15", cloth(d, 1));
    return 0;
}
