/* Definition, setting up, the step. */
#pragma once
#include "films.h"
#include "shear.h"

/* ==== >>fluid ==== */

#define FILTRATION__COOKIE 0x46494c54u

FILTRATION_API const char *filtration_cause_text(filtration_cause cause) {
    static const char *const texts[] = {FILTRATION_CAUSES(FILTRATION__TEXT)};
    return (int)cause >= 0 && (int)cause < (int)FILTRATION_CAUSE_COUNT ? texts[cause] : "unknown cause";
}

FILTRATION_API filtration_fluid_def filtration_fluid_default_def(void) {
    filtration_fluid_def def;
    memset(&def, 0, sizeof def);
    def.cookie = FILTRATION__COOKIE;
    def.nodes[0] = def.nodes[1] = def.nodes[2] = 32;
    def.voxel = 2.5e-6;
    def.density = 1000.0;
    def.viscosity = 1e-3;
    def.tau = 1.0;
    def.bulk_ratio = 2.0 / 3.0;
    def.magic = 3.0 / 16.0;
    def.speed_limit = 0.3;
    def.keep_mass = 1;
    def.skip = 1;
    def.threads = 1;
    return def;
}

/* Computes rates, faces and units of a lattice. Returns the time step [s]. */
static inline double filtration__find_units(const filtration_fluid_def *d, filtration__lattice *l) {
    double nu = (d->tau - 0.5) / 3.0, dt = nu * d->voxel * d->voxel * d->density / d->viscosity,
           bulk = 1.5 * d->bulk_ratio * nu;
    l->to_velocity = d->voxel / dt;
    l->to_pressure = d->density * l->to_velocity * l->to_velocity;
    l->to_force = l->to_pressure * d->voxel * d->voxel;
    l->rates.plus = 1.0 / d->tau;
    l->rates.minus = d->magic < HUGE_VAL ? 1.0 / (0.5 + d->magic / (d->tau - 0.5)) : l->rates.plus;
    l->rates.bulk = d->bulk_ratio == 2.0 / 3.0 ? l->rates.plus : 1.0 / (0.5 + 3.0 * bulk);
    l->rates.limit = d->speed_limit * d->speed_limit;
    for (int a = 0; a < 3; a++) l->rates.force[a] = d->body_force[a] * d->voxel / l->to_pressure;
    for (int f = 0; f < 6; f++) {
        l->face_density[f] = 3.0 * d->face_pressure[f] / l->to_pressure;
        for (int a = 0; a < 3; a++) l->face_velocity[f][a] = d->face_velocity[f][a] / l->to_velocity;
    }
    return dt;
}

static inline void filtration__set_units(filtration_fluid *fluid) {
    fluid->dt = filtration__find_units(&fluid->def, fluid->lattice);
}

/* Largest population, and largest pressure, speed and force of a source, in lattice units [-]. Below them no sum of a
   step or of a reader overflows, and a step can tell that the flow diverges. */
#define FILTRATION__LARGEST_POPULATION 1e25
#define FILTRATION__LARGEST_SOURCE 1e3

static inline const char *filtration__bad_source(const filtration_fluid_def *d) {
    filtration__lattice l;
    filtration__find_units(d, &l);
    for (int f = 0; f < 6; f++) {
        if (!(fabs(l.face_density[f]) < FILTRATION__LARGEST_SOURCE)) return "face_pressure";
        for (int a = 0; a < 3; a++)
            if (!(fabs(l.face_velocity[f][a]) < FILTRATION__LARGEST_SOURCE)) return "face_velocity";
    }
    for (int a = 0; a < 3; a++)
        if (!(fabs(l.rates.force[a]) < FILTRATION__LARGEST_SOURCE)) return "body_force";
    return NULL;
}

/* Returns whether a property of the fluid is in a range whose products stay far from the limits of doubles. */
static inline int filtration__is_property(double x) { return x >= 1e-15 && x <= 1e15; }

static inline const char *filtration__bad_face(const filtration_fluid_def *d) {
    for (int f = 0; f < 6; f++) {
        const filtration__face_kind *kind = filtration__kind_of(d->face[f]),
                                    *opposite = filtration__kind_of(d->face[f ^ 1]);
        if (!kind || !opposite) return "face";
        if ((kind->beyond == FILTRATION__REPEATED) != (opposite->beyond == FILTRATION__REPEATED)) return "face";
        if (kind->has_velocity < 2 && d->face_velocity[f][f / 2] != 0.0) return "face_velocity";
    }
    return NULL;
}

static inline const char *filtration__bad_field(const filtration_fluid_def *d) {
    double nodes = 1.0;
    if (d->cookie != FILTRATION__COOKIE) return "cookie";
    for (int a = 0; a < 3; a++) {
        if (d->nodes[a] < 1) return "nodes";
        nodes *= d->nodes[a];
    }
    if (!(nodes < 2147483648.0)) return "nodes";
    if (!filtration__is_property(d->voxel)) return "voxel";
    if (!filtration__is_property(d->density)) return "density";
    if (!filtration__is_property(d->viscosity)) return "viscosity";
    if (!(d->tau > 0.5 && d->tau <= 20.0)) return "tau";
    if (!(d->bulk_ratio >= 0.0 && d->bulk_ratio < HUGE_VAL)) return "bulk_ratio";
    if (!(d->magic > 0.0)) return "magic";
    if (d->lattice != FILTRATION_D3Q19 && d->lattice != FILTRATION_D3Q15) return "lattice";
    if (d->precision != FILTRATION_DOUBLE && (d->precision != FILTRATION_FLOAT || d->lattice == FILTRATION_D3Q15))
        return "precision";
    if (d->boundary != FILTRATION_CENTRAL_LINEAR && d->boundary != FILTRATION_HALF_WAY) return "boundary";
    if ((int)d->refill < 0 || d->refill > FILTRATION_REFILL_INTERPOLATION) return "refill";
    if (d->force != FILTRATION_MOMENTUM_EXCHANGE && d->force != FILTRATION_SHEAR_LAYER) return "force";
    if (filtration__bad_face(d)) return filtration__bad_face(d);
    if (!(d->speed_limit >= 1e-15 && d->speed_limit <= 0.5)) return "speed_limit";
    if (d->keep_mass != 0 && d->keep_mass != 1) return "keep_mass";
    if (d->skip != 0 && d->skip != 1) return "skip";
    if (d->threads < 1) return "threads";
    return filtration__bad_source(d);
}

FILTRATION_API filtration_status filtration_fluid_check_def(const filtration_fluid_def *def, const char **field) {
    const char *bad = def ? filtration__bad_field(def) : "def";
    if (field) *field = bad;
    return bad ? FILTRATION_BAD_DEF : FILTRATION_OK;
}

/* Wakes the slabs that faces and forces move. */
static inline void filtration__wake_sources(filtration_fluid *fluid) {
    filtration__lattice *l = fluid->lattice;
    int all = !fluid->def.skip || filtration__forced(&l->rates);
    for (int f = 0; f < 6; f++) {
        const double *v = l->face_velocity[f];
        const int moves = (l->face[f]->has_pressure && l->face_density[f] != 0.0) ||
                          (l->face[f]->has_velocity && (v[0] != 0.0 || v[1] != 0.0 || v[2] != 0.0));
        if (moves && f < 4) all = 1;
        if (moves && f >= 4) l->slab_active[f == 4 ? 0 : l->nz - 1] = 1;
    }
    filtration__wake(l, all);
}

static inline void filtration__set_shape(const filtration_fluid_def *d, filtration__lattice *l) {
    l->q = d->lattice == FILTRATION_D3Q15 ? 15 : 19;
    l->c = l->q == 15 ? filtration__c15 : filtration__c19;
    for (int i = 0; i < l->q; i++) {
        int cc = l->c[i][0] * l->c[i][0] + l->c[i][1] * l->c[i][1] + l->c[i][2] * l->c[i][2];
        l->w[i] = l->q == 15 ? (cc == 0   ? 2.0 / 9.0
                                : cc == 1 ? 1.0 / 9.0
                                          : 1.0 / 72.0)
                             : (cc == 0   ? 1.0 / 3.0
                                : cc == 1 ? 1.0 / 18.0
                                          : 1.0 / 36.0);
        l->whole_weight[i] = (int)(72.0 * l->w[i] + 0.5);
        l->squared_c[i] = cc;
        for (int a = 0; a < 3; a++) l->real_c[i][a] = l->c[i][a];
    }
    l->single = d->precision == FILTRATION_FLOAT;
    l->half_way = d->boundary == FILTRATION_HALF_WAY;
    l->refill = (int)d->refill;
    l->nx = d->nodes[0], l->ny = d->nodes[1], l->nz = d->nodes[2];
    for (int f = 0; f < 6; f++) l->face[f] = filtration__kind_of(d->face[f]);
    for (int a = 0; a < 3; a++) l->repeats[a] = filtration__repeats(l, a);
    l->periodic_x = l->repeats[0];
    l->ghost_y = !filtration__repeats(l, 1);
    l->ghost_z = !filtration__repeats(l, 2);
    filtration__list_entries(l);
    int line = FILTRATION__LINE / (l->single ? (int)sizeof(float) : (int)sizeof(double));
    l->lead = line;
    l->stride = line + ((ptrdiff_t)l->nx + line - 1) / line * line;
    l->bundle = l->q * l->stride;
    l->rows = (ptrdiff_t)(l->ny + 2 * l->ghost_y) * (l->nz + 2 * l->ghost_z);
    l->fluid_nodes = (ptrdiff_t)l->nx * l->ny * l->nz;
    filtration__list_places(l);
    l->block_bytes =
        (size_t)(l->rows * l->bundle + line) * (l->single ? sizeof(float) : sizeof(double)) + FILTRATION__LINE;
}

FILTRATION_API double filtration_fluid_bytes(const filtration_fluid_def *def) {
    filtration__lattice l;
    if (filtration_fluid_check_def(def, NULL) != FILTRATION_OK) return 0.0;
    memset(&l, 0, sizeof l);
    filtration__set_shape(def, &l);
    return (double)l.block_bytes + (double)l.fluid_nodes * sizeof(int32_t) + (double)l.ny * l.nz + l.nz +
           (double)sizeof l;
}

static inline size_t filtration__nodes(const filtration__lattice *l) {
    return (size_t)l->nx * (size_t)l->ny * (size_t)l->nz;
}

FILTRATION_API void filtration_fluid_free(filtration_fluid *fluid) {
    filtration__lattice *l = fluid ? fluid->lattice : NULL;
    if (!l) return;
    const filtration_memory *m = &fluid->def.memory;
    if (l->block) filtration__resize(m, l->block, l->block_bytes, 0);
    if (l->owner) filtration__resize(m, l->owner, filtration__nodes(l) * sizeof *l->owner, 0);
    if (l->row_state) filtration__resize(m, l->row_state, (size_t)l->ny * (size_t)l->nz, 0);
    if (l->slab_active) filtration__resize(m, l->slab_active, (size_t)l->nz, 0);
    if (l->links) filtration__resize(m, l->links, (size_t)l->link_count * sizeof *l->links, 0);
    if (l->balls) filtration__resize(m, l->balls, (size_t)l->ball_room * sizeof *l->balls, 0);
    if (l->gaps) filtration__resize(m, l->gaps, (size_t)l->gap_room * sizeof *l->gaps, 0);
    filtration__resize(m, l, sizeof *l, 0);
    fluid->lattice = NULL;
}

static inline int filtration__allocate(const filtration_fluid_def *def, filtration__lattice *l) {
    const filtration_memory *m = &def->memory;
    l->block = filtration__resize(m, NULL, 0, l->block_bytes);
    l->owner = (int32_t *)filtration__resize(m, NULL, 0, filtration__nodes(l) * sizeof *l->owner);
    l->row_state = (unsigned char *)filtration__resize(m, NULL, 0, (size_t)l->ny * (size_t)l->nz);
    l->slab_active = (unsigned char *)filtration__resize(m, NULL, 0, (size_t)l->nz);
    if (!l->block || !l->owner || !l->row_state || !l->slab_active) return 0;
    memset(l->block, 0, l->block_bytes);
    l->f = (void *)(((uintptr_t)l->block + FILTRATION__LINE - 1) / FILTRATION__LINE * FILTRATION__LINE);
    for (size_t k = 0; k < filtration__nodes(l); k++) l->owner[k] = FILTRATION__FLUID;
    memset(l->row_state, 0, (size_t)l->ny * (size_t)l->nz);
    memset(l->slab_active, 0, (size_t)l->nz);
    if (!def->solid.distance) return 1;
    filtration__mark_solid(def, l);
    filtration__list_links(def, l);
    if (!l->link_count) return 1;
    l->links = (filtration__link *)filtration__resize(m, NULL, 0, (size_t)l->link_count * sizeof *l->links);
    if (l->links) filtration__list_links(def, l);
    return l->links != NULL;
}

FILTRATION_API filtration_status filtration_fluid_init(filtration_fluid *fluid, const filtration_fluid_def *def) {
    if (!fluid) return FILTRATION_BAD_ARGUMENT;
    memset(fluid, 0, sizeof *fluid);
    if (filtration_fluid_check_def(def, NULL) != FILTRATION_OK) return FILTRATION_BAD_DEF;
    fluid->def = *def;
    filtration__lattice *l = fluid->lattice =
        (filtration__lattice *)filtration__resize(&def->memory, NULL, 0, sizeof *l);
    if (!l) return FILTRATION_NO_MEMORY;
    memset(l, 0, sizeof *l);
    filtration__set_shape(def, l);
    filtration__set_units(fluid);
    if (filtration__allocate(def, l)) return FILTRATION_OK;
    filtration_fluid_free(fluid);
    return FILTRATION_NO_MEMORY;
}

/* Reads sphere n of the caller in lattice units. Returns NULL, or what it would have to be. */
static inline const char *filtration__read_ball(const filtration_fluid *fluid, const filtration_spheres *s, ptrdiff_t n,
                                                filtration__ball *b) {
    const filtration__lattice *l = fluid->lattice;
    const int nodes[3] = {l->nx, l->ny, l->nz};
    b->radius = s->radius[n] / fluid->def.voxel;
    if (!(s->radius[n] >= 0.0)) return "radius: at least 0";
    if (b->radius == 0.0) return NULL;
    /* Points on a sphere are counted in int. */
    if (!(b->radius < (fluid->def.force == FILTRATION_SHEAR_LAYER ? 1e4 : 1e5)))
        return "radius: below 1e5 voxels (1e4 with the shear layer)";
    for (int a = 0; a < 3; a++) {
        double x = s->centre[3 * n + a] / fluid->def.voxel - 0.5;
        b->velocity[a] = s->velocity[3 * n + a] / l->to_velocity;
        b->spin[a] = s->spin[3 * n + a] * fluid->dt;
        if (!(fabs(x) < 1e6)) return "centre: within 1e6 voxels";
        if (!(fabs(b->velocity[a]) < 0.5)) return "velocity: below half a voxel a step";
        if (!(fabs(b->spin[a]) * b->radius < 0.5)) return "spin: a surface below half a voxel a step";
        if (filtration__repeats(l, a)) { /* the image nearest to its last position, or in the box */
            double home = b->steps ? b->centre[a] : 0.5 * (nodes[a] - 1);
            x -= nodes[a] * floor((x - home) / nodes[a] + 0.5);
            if (!(2.0 * b->radius <= nodes[a] * (1.0 + 1e-12))) return "radius: at most half a periodic box";
        }
        b->centre[a] = x;
    }
    return NULL;
}

static inline filtration_status filtration__room_for_balls(filtration_fluid *fluid, ptrdiff_t n) {
    filtration__lattice *l = fluid->lattice;
    if (n > l->ball_room) {
        ptrdiff_t room = n + n / 2 + 4;
        filtration__ball *balls = (filtration__ball *)filtration__resize(
            &fluid->def.memory, l->balls, (size_t)l->ball_room * sizeof *balls, (size_t)room * sizeof *balls);
        if (!balls) return FILTRATION_NO_MEMORY;
        l->balls = balls;
        l->ball_room = room;
    }
    if (n > l->gap_room) {
        filtration__gaps *gaps = (filtration__gaps *)filtration__resize(
            &fluid->def.memory, l->gaps, (size_t)l->gap_room * sizeof *gaps, (size_t)l->ball_room * sizeof *gaps);
        if (!gaps) return FILTRATION_NO_MEMORY;
        l->gaps = gaps;
        l->gap_room = l->ball_room;
    }
    for (; l->ball_count < n; l->ball_count++) memset(&l->balls[l->ball_count], 0, sizeof *l->balls);
    return FILTRATION_OK;
}

/* Returns how far a sphere's surface has moved since the last step [nodes]. */
static inline double filtration__moved(const filtration__ball *now, const filtration__ball *before) {
    double dd = 0.0;
    for (int a = 0; a < 3; a++) dd += (now->centre[a] - before->centre[a]) * (now->centre[a] - before->centre[a]);
    return sqrt(dd);
}

/* Moves a sphere from its last position to the present one: nodes change owner. A radius of 0, before or now, is no
   sphere. */
static inline void filtration__move_ball(filtration__lattice *l, ptrdiff_t n, const filtration__ball *now) {
    filtration__ball before = l->balls[n];
    int was = before.radius > 0.0, is = now->radius > 0.0;
    l->balls[n] = *now;
    if (was) filtration__swap_nodes(l, n, &before, is ? now : NULL, 1);
    if (is) filtration__swap_nodes(l, n, now, was ? &before : NULL, 0);
    if (was) filtration__fill_left(l, is ? now : &before, &before, 0);
    if (was) filtration__fill_left(l, is ? now : &before, &before, 1);
    for (int z = (int)floor(now->centre[2] - now->radius) - 2; is && z <= (int)ceil(now->centre[2] + now->radius) + 2;
         z++) {
        int k = l->ghost_z ? z : ((z % l->nz) + l->nz) % l->nz;
        if (k >= 0 && k < l->nz) l->slab_active[k] = 1;
    }
}

/* Reads sphere n of the caller; none beyond the last. Returns OK, BAD_ARGUMENT or TOO_FAST, and the rule that the
   sphere breaks. */
static inline filtration_status filtration__next_ball(const filtration_fluid *fluid, const filtration_spheres *s,
                                                      ptrdiff_t n, filtration__ball *now, const char **rule) {
    const filtration__ball *before = &fluid->lattice->balls[n];
    *now = *before;
    now->radius = 0.0;
    *rule = s && n < s->n ? filtration__read_ball(fluid, s, n, now) : NULL;
    if (*rule) return FILTRATION_BAD_ARGUMENT;
    if (now->radius == 0.0) now->steps = 0;
    else if (before->radius > 0.0 && !(filtration__moved(now, before) <= 0.5))
        *rule = "centre: moved by at most half a voxel a step";
    return *rule ? FILTRATION_TOO_FAST : FILTRATION_OK;
}

/* Moves the spheres to their present positions: all of them or, if one is refused, none. */
static inline filtration_status filtration__bring_balls(filtration_fluid *fluid, const filtration_spheres *s) {
    filtration__lattice *l = fluid->lattice;
    filtration__ball now;
    const char *rule;
    ptrdiff_t n = s ? s->n : 0;
    if (n < 0 || (n > 0 && !(s->centre && s->velocity && s->spin && s->radius && s->force && s->torque)))
        return FILTRATION_BAD_ARGUMENT;
    if (filtration__room_for_balls(fluid, n) != FILTRATION_OK) return FILTRATION_NO_MEMORY;
    for (ptrdiff_t k = 0; k < l->ball_count; k++) {
        const filtration_status status = filtration__next_ball(fluid, s, k, &now, &rule);
        if (status == FILTRATION_OK) continue;
        fluid->problem.cause = FILTRATION_SPHERE, fluid->problem.rule = rule;
        fluid->problem.node[0] = (int)k, fluid->problem.node[1] = fluid->problem.node[2] = 0;
        fluid->problem.step = fluid->steps;
        return status;
    }
    for (ptrdiff_t k = 0; k < l->ball_count; k++) {
        (void)filtration__next_ball(fluid, s, k, &now, &rule);
        filtration__move_ball(l, k, &now);
    }
    return FILTRATION_OK;
}

static inline void filtration__give_forces(const filtration_fluid *fluid, const filtration_spheres *s) {
    const filtration__lattice *l = fluid->lattice;
    for (ptrdiff_t n = 0; s && n < s->n; n++) {
        const filtration__ball *b = &l->balls[n];
        double share = b->steps > 1 ? 0.5 : 1.0, other = b->steps > 1 ? 0.5 : 0.0, force = l->to_force,
               torque = force * fluid->def.voxel;
        for (int a = 0; a < 3; a++) {
            int none = !(b->radius > 0.0);
            s->force[3 * n + a] = none ? 0.0 : force * (share * b->force[0][a] + other * b->force[1][a]);
            s->torque[3 * n + a] = none ? 0.0 : torque * (share * b->torque[0][a] + other * b->torque[1][a]);
        }
    }
}

static inline int filtration__is_closed(const filtration__lattice *l) {
    for (int f = 0; f < 6; f++)
        if (l->face[f]->beyond == FILTRATION__NOTHING && !l->face[f]->is_touched) return 0;
    return 1;
}

/* Adds the same density to every fluid node, so that the mean is def.density. */
static inline filtration_status filtration__level(filtration_fluid *fluid) {
    filtration__lattice *l = fluid->lattice;
    double sum = 0.0, u[3];
    ptrdiff_t count = 0;
    for (int z = 0; z < l->nz; z++)
        for (int y = 0; y < l->ny; y++) {
            double row = 0.0;
            for (int x = 0; x < l->nx; x++) {
                if (l->owner[filtration__node(l, x, y, z)] != FILTRATION__FLUID) continue;
                row += filtration__moments(l, x, y, z, u);
                count++;
            }
            sum += row;
        }
    if (count == 0 || sum == 0.0) return FILTRATION_OK;
    const double r = -sum / (double)count;
    if (!(fabs(r) < HUGE_VAL)) return FILTRATION_DIVERGED;
    for (int z = 0; z < l->nz; z++)
        for (int y = 0; y < l->ny; y++)
            for (int x = 0; x < l->nx; x++) {
                if (l->owner[filtration__node(l, x, y, z)] != FILTRATION__FLUID) continue;
                for (int i = 0; i < l->q; i++) {
                    ptrdiff_t place = filtration__incoming(l, x, y, z, i);
                    filtration__put(l, place, filtration__get(l, place) + l->w[i] * r);
                }
            }
    memset(l->slab_active, 1, (size_t)l->nz);
    for (ptrdiff_t n = 0; n < l->ball_count; n++) l->balls[n].density += r;
    fluid->mass_correction += r;
    return FILTRATION_OK;
}

FILTRATION_API filtration_status filtration_fluid_step(filtration_fluid *fluid, const filtration_spheres *spheres) {
    if (!fluid || !fluid->lattice) return FILTRATION_BAD_ARGUMENT;
    filtration__lattice *l = fluid->lattice;
    if (fluid->problem.cause == FILTRATION_SPEED || fluid->problem.cause == FILTRATION_NOT_FINITE)
        return FILTRATION_DIVERGED;
    memset(&fluid->problem, 0, sizeof fluid->problem);
    filtration_status status = filtration__bring_balls(fluid, spheres);
    if (status != FILTRATION_OK) return status;
    const filtration_parallel *p = &fluid->def.parallel;
    int threads = fluid->def.threads;
    filtration__wake_sources(fluid);
    l->odd = !l->odd;
    filtration__for_each(p, threads, FILTRATION__TASKS, filtration__collide_task, l);
    for (int task = 0; task < FILTRATION__TASKS; task++) fluid->updates += l->updated[task];
    fluid->steps++;
    fluid->time += fluid->dt;
    if (filtration__find_problem(l, &fluid->problem)) {
        fluid->problem.step = fluid->steps;
        fluid->problem.cell_reynolds = fluid->problem.speed * 3.0 / (fluid->def.tau - 0.5);
        return FILTRATION_DIVERGED;
    }
    if (filtration__faces_wait(l)) filtration__for_each(p, threads, FILTRATION__TASKS, filtration__face_task, l);
    if (l->link_count) filtration__for_each(p, threads, FILTRATION__TASKS, filtration__link_task, l);
    if (l->ball_count) {
        filtration__for_each(p, threads, FILTRATION__TASKS, filtration__ball_task, l);
        filtration__for_each(p, threads, FILTRATION__TASKS, filtration__film_task, l);
    }
    if (fluid->def.force == FILTRATION_SHEAR_LAYER) filtration__shear_forces(fluid);
    filtration__give_forces(fluid, spheres);
    if (fluid->def.keep_mass && l->left && fluid->steps % 256 == 0 && filtration__is_closed(l)) {
        l->left = 0;
        return filtration__level(fluid);
    }
    return FILTRATION_OK;
}

FILTRATION_API filtration_status filtration_fluid_run(filtration_fluid *fluid, int64_t steps,
                                                      const filtration_spheres *spheres) {
    filtration_status status = FILTRATION_OK;
    if (!fluid || !fluid->lattice || steps < 0) return FILTRATION_BAD_ARGUMENT;
    for (int64_t n = 0; n < steps && status == FILTRATION_OK; n++) status = filtration_fluid_step(fluid, spheres);
    return status;
}
