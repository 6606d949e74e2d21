/* Writes a fluid as bytes and reads it back, bit for bit. */
#pragma once
#include "flow.h"

/* ==== >>save ==== */

/* Everything but arrays. All fields have eight bytes, so that there is no padding. */
typedef struct filtration__header {
    uint64_t magic;
    int64_t nodes[3], directions, single, faces[6], boundary, refill, force_mode, keep_mass, links, solid_nodes, balls,
        odd, left, steps, updates;
    double bulk_ratio, lambda, tau, time, mass_correction, body_force[3], face_velocity[6][3], face_pressure[6], voxel,
        density, viscosity;
} filtration__header;

#define FILTRATION__MAGIC UINT64_C(0x336c6966656c6472) /* changes with the format */

static inline uint64_t filtration__checksum(uint64_t sum, const void *data, size_t bytes) {
    const unsigned char *p = (const unsigned char *)data;
    size_t k = 0;
    for (; k + 8 <= bytes; k += 8) {
        uint64_t word;
        memcpy(&word, p + k, 8);
        sum = (sum ^ word) * UINT64_C(0x100000001b3);
        sum ^= sum >> 29;
    }
    for (; k < bytes; k++) sum = (sum ^ p[k]) * UINT64_C(0x100000001b3);
    return sum;
}

static inline filtration__header filtration__make_header(const filtration_fluid *fluid) {
    const filtration__lattice *l = fluid->lattice;
    const filtration_fluid_def *d = &fluid->def;
    filtration__header h;
    memset(&h, 0, sizeof h);
    h.magic = FILTRATION__MAGIC;
    for (int a = 0; a < 3; a++) h.nodes[a] = d->nodes[a];
    for (int f = 0; f < 6; f++) h.faces[f] = (int64_t)d->face[f];
    h.boundary = (int64_t)d->boundary, h.refill = (int64_t)d->refill, h.force_mode = (int64_t)d->force,
    h.keep_mass = d->keep_mass;
    h.bulk_ratio = d->bulk_ratio, h.lambda = d->magic, h.left = l->left;
    h.directions = l->q, h.single = l->single, h.links = l->link_count, h.solid_nodes = l->solid_nodes;
    h.balls = l->ball_count, h.odd = l->odd, h.steps = fluid->steps, h.updates = fluid->updates;
    h.tau = d->tau, h.time = fluid->time, h.mass_correction = fluid->mass_correction;
    h.voxel = d->voxel, h.density = d->density, h.viscosity = d->viscosity;
    memcpy(h.body_force, d->body_force, sizeof h.body_force);
    memcpy(h.face_velocity, d->face_velocity, sizeof h.face_velocity);
    memcpy(h.face_pressure, d->face_pressure, sizeof h.face_pressure);
    return h;
}

/* Lists the arrays of a save, in order. Returns their number. */
static inline int filtration__saved_arrays(const filtration__lattice *l, void *data[4], size_t bytes[4]) {
    data[0] = l->slab_active, bytes[0] = (size_t)l->nz;
    data[1] = l->owner, bytes[1] = filtration__nodes(l) * sizeof *l->owner;
    data[2] = l->balls, bytes[2] = (size_t)l->ball_count * sizeof *l->balls;
    data[3] = l->f, bytes[3] = l->block_bytes - FILTRATION__LINE;
    return 4;
}

FILTRATION_API filtration_status filtration_fluid_save(const filtration_fluid *fluid, filtration_write_fn write,
                                                       void *user) {
    if (!fluid || !fluid->lattice || !write) return FILTRATION_BAD_ARGUMENT;
    filtration__header h = filtration__make_header(fluid);
    void *data[4];
    size_t bytes[4];
    uint64_t sum = filtration__checksum(0, &h, sizeof h);
    if (!write(user, &h, sizeof h)) return FILTRATION_STREAM;
    int n = filtration__saved_arrays(fluid->lattice, data, bytes);
    for (int k = 0; k < n; k++) {
        if (!bytes[k]) continue;
        if (!write(user, data[k], bytes[k])) return FILTRATION_STREAM;
        sum = filtration__checksum(sum, data[k], bytes[k]);
    }
    return write(user, &sum, sizeof sum) ? FILTRATION_OK : FILTRATION_STREAM;
}

/* Puts the fluid at rest at time 0, without spheres. */
static inline void filtration__rest(filtration_fluid *fluid) {
    filtration__lattice *l = fluid->lattice;
    memset(l->block, 0, l->block_bytes);
    memset(l->slab_active, 0, (size_t)l->nz);
    for (size_t k = 0; k < filtration__nodes(l); k++)
        if (l->owner[k] != FILTRATION__SOLID) l->owner[k] = FILTRATION__FLUID;
    l->ball_count = 0;
    l->odd = l->left = 0;
    fluid->time = fluid->mass_correction = 0.0;
    fluid->steps = fluid->updates = 0;
    memset(&fluid->problem, 0, sizeof fluid->problem);
}

/* Returns whether a save belongs to this fluid. */
static inline int filtration__fits(const filtration_fluid *fluid, const filtration__header *h) {
    filtration__header own = filtration__make_header(fluid);
    int same = h->magic == own.magic && h->directions == own.directions && h->single == own.single &&
               h->links == own.links && h->solid_nodes == own.solid_nodes && h->voxel == own.voxel &&
               h->density == own.density && h->viscosity == own.viscosity && h->boundary == own.boundary &&
               h->refill == own.refill && h->force_mode == own.force_mode && h->keep_mass == own.keep_mass &&
               h->bulk_ratio == own.bulk_ratio && h->lambda == own.lambda && (h->left == 0 || h->left == 1) &&
               h->balls >= 0 && h->balls < INT32_MAX && (h->odd == 0 || h->odd == 1) && h->time >= 0.0 &&
               h->time < HUGE_VAL && fabs(h->mass_correction) < HUGE_VAL && h->steps >= 0 && h->updates >= 0;
    for (int a = 0; a < 3; a++) same = same && h->nodes[a] == own.nodes[a];
    for (int f = 0; f < 6; f++) same = same && h->faces[f] == own.faces[f];
    return same;
}

static inline filtration_status filtration__read_arrays(filtration_fluid *fluid, const filtration__header *h,
                                                        filtration_read_fn read, void *user) {
    filtration__lattice *l = fluid->lattice;
    void *data[4];
    size_t bytes[4];
    uint64_t sum = filtration__checksum(0, h, sizeof *h), stored = 0;
    if (filtration__room_for_balls(fluid, (ptrdiff_t)h->balls) != FILTRATION_OK) return FILTRATION_NO_MEMORY;
    int n = filtration__saved_arrays(l, data, bytes);
    for (int k = 0; k < n; k++) {
        if (!bytes[k]) continue;
        if (!read(user, data[k], bytes[k])) return FILTRATION_STREAM;
        sum = filtration__checksum(sum, data[k], bytes[k]);
    }
    if (!read(user, &stored, sizeof stored)) return FILTRATION_STREAM;
    return stored == sum ? FILTRATION_OK : FILTRATION_BAD_DATA;
}

/* Marks the solid's nodes again, because a damaged save may have changed them. */
static inline void filtration__remark(filtration_fluid *fluid) {
    filtration__lattice *l = fluid->lattice;
    for (size_t k = 0; k < filtration__nodes(l); k++) l->owner[k] = FILTRATION__FLUID;
    l->fluid_nodes = (ptrdiff_t)filtration__nodes(l);
    l->solid_nodes = 0;
    if (fluid->def.solid.distance) filtration__mark_solid(&fluid->def, l);
}

FILTRATION_API filtration_status filtration_fluid_load(filtration_fluid *fluid, filtration_read_fn read, void *user) {
    filtration__header h;
    if (!fluid || !fluid->lattice || !read) return FILTRATION_BAD_ARGUMENT;
    filtration__rest(fluid);
    if (!read(user, &h, sizeof h)) return FILTRATION_STREAM;
    filtration_fluid_def def = fluid->def;
    def.tau = h.tau;
    memcpy(def.body_force, h.body_force, sizeof h.body_force);
    memcpy(def.face_velocity, h.face_velocity, sizeof h.face_velocity);
    memcpy(def.face_pressure, h.face_pressure, sizeof h.face_pressure);
    if (!filtration__fits(fluid, &h) || filtration_fluid_check_def(&def, NULL) != FILTRATION_OK)
        return FILTRATION_BAD_DATA;
    filtration_status status = filtration__read_arrays(fluid, &h, read, user);
    if (status != FILTRATION_OK) {
        filtration__remark(fluid);
        filtration__rest(fluid);
        return status;
    }
    (void)filtration__change(fluid, &def);
    fluid->lattice->odd = (int)h.odd, fluid->lattice->left = (int)h.left;
    fluid->time = h.time, fluid->mass_correction = h.mass_correction;
    fluid->steps = h.steps, fluid->updates = h.updates;
    return FILTRATION_OK;
}
