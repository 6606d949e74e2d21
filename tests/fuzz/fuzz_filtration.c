/* Any program of public calls of filtration.h: a small box of fluid with solids and moving spheres; the filtration
   equation with any numbers. Two fluids get the same calls; one of them shares its tasks otherwise, skips nothing, runs
   out of memory now and then, and is thrown away for what the other saves. What must hold: both answer the same, with a
   status that the call documents, and end with the same bits; a refused call changes nothing; the mass of the liquid is
   kept, or made right by filtration_fluid_keep_mass; readers give numbers; nothing is left in memory. */
#include "../failing_allocator.h"
#include "filtration.h"
#include "programs.h"

enum { NUMBERS = 16, MOST = 5, SIDES = 2 };
typedef struct call {
    int kind, pick, odd;
    double u[NUMBERS], value;
} call;

static double number(const call *c, int k, double low, double high) {
    return c->odd == k ? c->value : low + (high - low) * c->u[k];
}
static call draw_call(fuzz_draws *d, int kinds, int odds) {
    call c;
    c.kind = fuzz_one_of(d, kinds), c.pick = fuzz_one_of(d, 1 << 20);
    for (int k = 0; k < NUMBERS; k++) c.u[k] = fuzz_uniform(d);
    c.odd = fuzz_one_of(d, odds) == 0 ? fuzz_one_of(d, NUMBERS) : -1;
    c.value = fuzz_hostile_number(d);
    return c;
}
static void mix(uint64_t *hash, const double *v, ptrdiff_t n) {
    for (ptrdiff_t k = 0; k < n; k++) fuzz_mix_number(hash, v[k]);
}
static int is_finite(double v) { return fabs(v) <= DBL_MAX; }

/* ---- bytes in memory ---- */

typedef struct stream {
    unsigned char *data;
    size_t size, room, at;
} stream;
static int write_bytes(void *user, const void *data, size_t n) {
    stream *s = (stream *)user;
    if (s->size + n > s->room) {
        s->room = 2 * (s->size + n);
        unsigned char *more = (unsigned char *)realloc(s->data, s->room);
        FUZZ_HOLDS(more != NULL);
        s->data = more;
    }
    memcpy(s->data + s->size, data, n), s->size += n;
    return 1;
}
static int read_bytes(void *user, void *data, size_t n) {
    stream *s = (stream *)user;
    if (n > s->size - s->at) return 0;
    memcpy(data, s->data + s->at, n), s->at += n;
    return 1;
}

/* ---- two fluids with their spheres ---- */

typedef struct side {
    filtration_fluid fluid;
    failing_allocator memory;
    filtration_spheres spheres;
    double centre[3 * MOST], velocity[3 * MOST], spin[3 * MOST], radius[MOST], force[3 * MOST], torque[3 * MOST];
} side;
typedef struct solids {
    filtration_cloth cloth;
    filtration_bed bed;
    filtration_image image;
    double a[9], b[9], radius[3];
    unsigned char cubes[64];
} solids;

static void run_backwards(void *user, int tasks, void (*task)(void *context, int index), void *context) {
    (void)user;
    for (int k = tasks; k-- > 0;) task(context, k);
}

static filtration_fluid_def draw_def(const call *c, const call *f) {
    filtration_fluid_def def = filtration_fluid_default_def();
    for (int a = 0; a < 3; a++) def.nodes[a] = 4 + (int)(8.0 * f->u[a]);
    if (c->odd == 15) def.nodes[c->pick % 3] = c->pick % 2 ? 0 : -3;
    def.voxel = number(c, 0, 1e-6, 1e-5), def.density = number(c, 1, 800.0, 1200.0),
    def.viscosity = number(c, 2, 5e-4, 2e-3);
    def.tau = number(c, 3, 0.55, 1.5), def.bulk_ratio = c->pick % 3 ? 2.0 / 3.0 : number(c, 4, 0.0, 5.0);
    def.magic = c->pick % 5 ? number(c, 5, 0.1, 0.3) : HUGE_VAL;
    def.lattice = c->pick / 2 % 4 ? FILTRATION_D3Q19 : FILTRATION_D3Q15;
    def.precision = def.lattice == FILTRATION_D3Q19 && c->pick / 8 % 3 == 0 ? FILTRATION_FLOAT : FILTRATION_DOUBLE;
    def.boundary = (filtration_boundary)(c->pick / 32 % 2), def.refill = (filtration_refill)(c->pick / 64 % 3);
    def.force = (filtration_force_mode)(f->pick % 5 == 0);
    for (int a = 0; a < 3; a++) {
        const int kind = (int)(6.0 * f->u[3 + a]);
        if (kind == 1) def.face[2 * a] = def.face[2 * a + 1] = FILTRATION_WALL;
        if (kind == 2) def.face[2 * a] = FILTRATION_SYMMETRY, def.face[2 * a + 1] = FILTRATION_WALL;
        if (kind == 3)
            def.face[2 * a] = def.face[2 * a + 1] = FILTRATION_PRESSURE,
                         def.face_pressure[2 * a] = number(f, 6, 0.0, 5.0);
        if (kind == 3 && f->pick % 2) def.face[2 * a + 1] = FILTRATION_OUTLET;
        def.body_force[a] = f->u[9 + a] < 0.3 ? number(c, 6 + a, -1e4, 1e4) : 0.0;
    }
    if (def.face[0] == FILTRATION_WALL) def.face_velocity[0][1] = number(f, 7, -1e-3, 1e-3);
    return def;
}

static filtration_solid draw_solid(solids *s, const filtration_fluid_def *def, const call *c,
                                   const filtration_memory *memory) {
    const double box[3] = {def->nodes[0] * def->voxel, def->nodes[1] * def->voxel, def->nodes[2] * def->voxel};
    const int periodic[3] = {def->face[0] == FILTRATION_PERIODIC, def->face[2] == FILTRATION_PERIODIC,
                             def->face[4] == FILTRATION_PERIODIC};
    filtration_solid none;
    memset(&none, 0, sizeof none);
    switch (c->pick % 6) {
    case 0:
        if (filtration_cloth_make(&s->cloth, number(c, 0, 0.1, 0.3) * box[0], number(c, 1, 0.1, 0.3) * box[0],
                                  (filtration_weave)(c->pick / 8 % 2), 0.5 * box[2]) != FILTRATION_OK)
            return none;
        return filtration_cloth_solid(&s->cloth);
    case 1:
        for (int k = 0; k < 9; k++) s->a[k] = c->u[k] * box[k % 3], s->b[k] = c->u[k + 3] * box[k % 3];
        for (int k = 0; k < 3; k++) s->radius[k] = number(c, 12 + k, 0.05, 0.3) * box[0];
        if (filtration_bed_init(&s->bed, 3, s->a, c->pick / 8 % 2 ? s->b : NULL, s->radius, box, periodic, 0.5 * box[0],
                                memory) != FILTRATION_OK)
            return none;
        return filtration_bed_solid(&s->bed);
    case 2:
        for (int k = 0; k < 64; k++) s->cubes[k] = (unsigned char)(c->pick >> k % 20 & k % 3 & 1);
        s->image.n[0] = s->image.n[1] = s->image.n[2] = 4, s->image.edge = number(c, 0, 0.1, 0.3) * box[0],
        s->image.reach = 2;
        memcpy(s->image.periodic, periodic, sizeof periodic);
        s->image.solid = s->cubes;
        return filtration_image_check(&s->image) == FILTRATION_OK ? filtration_image_solid(&s->image) : none;
    default: return none;
    }
}

static uint64_t digest(const side *s) {
    uint64_t hash = 0xcbf29ce484222325u;
    const filtration_fluid *f = &s->fluid;
    fuzz_mix_bits(&hash, (uint64_t)f->steps), fuzz_mix_number(&hash, f->time),
        fuzz_mix_number(&hash, f->mass_correction);
    for (int z = 0; z < f->def.nodes[2]; z++)
        for (int y = 0; y < f->def.nodes[1]; y++)
            for (int x = 0; x < f->def.nodes[0]; x++) {
                filtration_sample p;
                FUZZ_HOLDS(filtration_fluid_at(f, x, y, z, &p) == FILTRATION_OK);
                mix(&hash, p.velocity, 3), fuzz_mix_number(&hash, p.pressure),
                    fuzz_mix_bits(&hash, (uint64_t)(int64_t)p.owner);
            }
    mix(&hash, s->centre, 3 * s->spheres.n), mix(&hash, s->velocity, 3 * s->spheres.n),
        mix(&hash, s->spin, 3 * s->spheres.n);
    mix(&hash, s->force, 3 * s->spheres.n), mix(&hash, s->torque, 3 * s->spheres.n);
    return hash;
}

static void flow(void *user, const double point[3], double velocity[3], double *pressure) {
    const call *c = (const call *)user;
    for (int a = 0; a < 3; a++)
        velocity[a] = number(c, a, -1e-3, 1e-3) * riddle_sin(number(c, 3, 1e4, 1e6) * point[(a + 1) % 3]);
    *pressure = number(c, 4, -1.0, 1.0);
}

/* ---- calls ---- */

enum {
    STEP,
    RUN,
    MOVE,
    ADD_SPHERE,
    PUSH_SPHERE,
    DROP_SPHERE,
    SET_TAU,
    SET_FORCE,
    SET_PRESSURE,
    SET_VELOCITY,
    SET_FLOW,
    KEEP_MASS,
    PERMEABILITY,
    CALLS
};

static filtration_status add_sphere(side *s, const call *c) {
    const filtration_fluid_def *def = &s->fluid.def;
    const ptrdiff_t i = s->spheres.n;
    if (i >= MOST) return FILTRATION_OK;
    for (int a = 0; a < 3; a++) {
        s->centre[3 * i + a] = number(c, a, -0.2, 1.2) * def->nodes[a] * def->voxel;
        s->velocity[3 * i + a] = s->spin[3 * i + a] = s->force[3 * i + a] = s->torque[3 * i + a] = 0.0;
    }
    s->radius[i] = number(c, 3, 1.2, 2.6) * def->voxel;
    s->spheres.n++;
    return FILTRATION_OK;
}

static filtration_status apply(side *s, const call *c) {
    filtration_fluid *f = &s->fluid;
    filtration_motion_def motion = filtration_motion_default_def();
    filtration_permeability_result result;
    double contact[3 * MOST];
    const double three[3] = {number(c, 0, -1e4, 1e4), number(c, 1, -1e4, 1e4), number(c, 2, -1e4, 1e4)};
    const double slow[3] = {number(c, 0, -1e-3, 1e-3), number(c, 1, -1e-3, 1e-3), number(c, 2, -1e-3, 1e-3)};
    const ptrdiff_t i = s->spheres.n > 0 ? c->pick % s->spheres.n : -1;
    call own = *c;
    switch (c->kind) {
    case STEP: return filtration_fluid_step(f, c->pick % 4 ? &s->spheres : NULL);
    case RUN: return filtration_fluid_run(f, c->odd == 15 ? -1 : c->pick % 6, &s->spheres);
    case MOVE:
        motion.density = number(c, 0, 1100.0, 3000.0), motion.modulus = number(c, 1, 1e6, 1e7),
        motion.restitution = number(c, 2, 0.2, 1.0);
        motion.friction = number(c, 3, 0.0, 1.0), motion.sub_steps = 1 + c->pick % 4,
        motion.lubrication = c->pick / 4 % 2;
        motion.least_gap = number(c, 4, 1e-3, 1e-2), motion.spin = c->pick / 8 % 2,
        motion.fixed_axes[c->pick % 3] = c->pick / 16 % 2;
        for (int a = 0; a < 3; a++) motion.gravity[a] = number(c, 5 + a, -10.0, 10.0);
        return filtration_move(&motion, f, &s->spheres, c->odd == 9 ? c->value : 1.0, c->pick % 2 ? contact : NULL);
    case ADD_SPHERE: return add_sphere(s, c);
    case PUSH_SPHERE:
        for (int a = 0; a < 3 && i >= 0; a++)
            s->velocity[3 * i + a] = slow[a], s->spin[3 * i + a] = number(c, 3 + a, -100.0, 100.0);
        return FILTRATION_OK;
    case DROP_SPHERE:
        if (i >= 0) s->radius[i] = c->odd >= 0 ? c->value : 0.0;
        return FILTRATION_OK;
    case SET_TAU: return filtration_fluid_set_tau(f, number(c, 0, 0.55, 1.5));
    case SET_FORCE: return filtration_fluid_set_body_force(f, three);
    case SET_PRESSURE:
        return filtration_fluid_set_face_pressure(f, c->odd == 3 ? 99 : c->pick % 6, number(c, 0, -5.0, 5.0));
    case SET_VELOCITY: return filtration_fluid_set_face_velocity(f, c->odd == 3 ? -1 : c->pick % 6, slow);
    case SET_FLOW: return filtration_fluid_set_flow(f, c->odd == 15 ? NULL : flow, &own);
    case KEEP_MASS: return filtration_fluid_keep_mass(f);
    default:
        return filtration_fluid_permeability(f, c->pick % 2 ? &s->spheres : NULL, c->pick % 3, number(c, 0, 0.01, 1.0),
                                             number(c, 1, 1e-3, 1e-2), 40, &result);
    }
}

static int may_answer(const call *c, filtration_status status) {
    const int steps = c->kind == STEP || c->kind == RUN || c->kind == PERMEABILITY;
    switch (status) {
    case FILTRATION_OK:
    case FILTRATION_BAD_ARGUMENT: return 1;
    case FILTRATION_BAD_DEF: return c->kind == MOVE;
    case FILTRATION_TOO_FAST: return steps || c->kind == MOVE;
    case FILTRATION_DIVERGED: return steps || c->kind == KEEP_MASS;
    case FILTRATION_NOT_STEADY: return c->kind == PERMEABILITY;
    default: return 0;
    }
}

static void load_in_place(side *s, const side *of) {
    stream bytes = {NULL, 0, 0, 0};
    FUZZ_HOLDS(filtration_fluid_save(&of->fluid, write_bytes, &bytes) == FILTRATION_OK);
    FUZZ_HOLDS(filtration_fluid_load(&s->fluid, read_bytes, &bytes) == FILTRATION_OK);
    free(bytes.data);
}

static void read_all(const side *s, const call *c, int over) {
    const filtration_fluid *f = &s->fluid;
    filtration_sample sample;
    double v[3], solid[3];
    filtration_fluid_mean_velocity(f, v), filtration_fluid_solid_force(f, solid);
    const double flux = filtration_fluid_flux(f, c->pick % 4 - 1, c->pick % 9 - 1);
    const double sums =
        v[0] + v[1] + v[2] + solid[0] + solid[1] + solid[2] + filtration_fluid_mass(f) + filtration_fluid_max_speed(f);
    FUZZ_HOLDS(over || is_finite(sums));
    FUZZ_HOLDS(filtration_fluid_porosity(f) >= 0.0 && filtration_fluid_porosity(f) <= 1.0);
    FUZZ_HOLDS(filtration_fluid_at(f, -1, 0, 0, &sample) == FILTRATION_BAD_ARGUMENT &&
               (is_finite(flux) || isnan(flux) || over));
    filtration_fluid_fields(f, NULL, NULL, NULL);
}

/* What the liquid's mass should be when its mean density is that of the definition [kg]. */
static double right_mass(const filtration_fluid *f) {
    const filtration_fluid_def *d = &f->def;
    return d->density * filtration_fluid_porosity(f) * d->nodes[0] * d->nodes[1] * d->nodes[2] * d->voxel * d->voxel *
           d->voxel;
}

static uint64_t fluid(fuzz_draws *d) {
    side s[SIDES];
    solids body;
    failing_allocator of_solid;
    filtration_memory hook = {failing_fn, &of_solid};
    const call c = draw_call(d, 1, 12), f = draw_call(d, 1, 30);
    call g = draw_call(d, 1, 30);
    memset(s, 0, sizeof s), memset(&body, 0, sizeof body), failing_init(&of_solid);
    filtration_fluid_def def = draw_def(&c, &f);
    if (filtration_fluid_check_def(&def, NULL) == FILTRATION_OK) def.solid = draw_solid(&body, &def, &g, &hook);
    uint64_t hash = 0xcbf29ce484222325u;
    filtration_status made[SIDES];
    for (int k = 0; k < SIDES; k++) {
        failing_init(&s[k].memory);
        def.memory.fn = failing_fn, def.memory.user = &s[k].memory;
        def.threads = 1 + k, def.skip = 1 - k;
        if (k) def.parallel.fn = run_backwards;
        const double bytes = filtration_fluid_bytes(&def);
        made[k] = filtration_fluid_init(&s[k].fluid, &def);
        FUZZ_HOLDS(made[k] == FILTRATION_OK || made[k] == FILTRATION_BAD_DEF);
        FUZZ_HOLDS((made[k] == FILTRATION_BAD_DEF) == (filtration_fluid_check_def(&def, NULL) != FILTRATION_OK) &&
                   (bytes > 0.0 || made[k] != FILTRATION_OK));
        s[k].spheres.centre = s[k].centre, s[k].spheres.velocity = s[k].velocity, s[k].spheres.spin = s[k].spin;
        s[k].spheres.radius = s[k].radius, s[k].spheres.force = s[k].force, s[k].spheres.torque = s[k].torque;
    }
    FUZZ_HOLDS(made[0] == made[1]);
    int over = 0, extreme = c.odd >= 0 || f.odd >= 0 || g.odd >= 0; /* an odd number was accepted: sums may overflow */
    for (int calls = made[0] == FILTRATION_OK ? 5 + fuzz_one_of(d, 20) : 0; calls > 0 && !over; calls--) {
        call q = draw_call(d, CALLS + 8, 14);
        if (q.kind >= CALLS) q.kind = q.kind % 2 ? RUN : STEP;
        const int fails = fuzz_one_of(d, 10) == 0, fail_at = fuzz_one_of(d, 3);
        const uint64_t before = digest(&s[0]);
        const double mass = filtration_fluid_mass(&s[0].fluid);
        const filtration_status a = apply(&s[0], &q);
        s[1].memory.fail_at = fails ? s[1].memory.calls + fail_at : -1, s[1].memory.fail_count = 1,
        s[1].memory.has_failed = 0;
        filtration_status b = apply(&s[1], &q);
        s[1].memory.fail_at = -1;
        if (b == FILTRATION_NO_MEMORY && s[1].memory.has_failed) { /* it can be read and saved; go on from the other */
            read_all(&s[1], &q, 0);
            load_in_place(&s[1], &s[0]);
            memcpy(s[1].centre, s[0].centre, sizeof s[0].centre),
                memcpy(s[1].velocity, s[0].velocity, sizeof s[0].velocity);
            memcpy(s[1].spin, s[0].spin, sizeof s[0].spin), memcpy(s[1].force, s[0].force, sizeof s[0].force);
            memcpy(s[1].torque, s[0].torque, sizeof s[0].torque);
            b = a;
        }
        if (fuzz_traces)
            fprintf(stderr, "call %2d odd %2d %g: a %d, b %d; %ld spheres, step %lld\n", q.kind, q.odd, q.value, a, b,
                    (long)s[0].spheres.n, (long long)s[0].fluid.steps);
        FUZZ_HOLDS(a == b && may_answer(&q, a));
        over = a == FILTRATION_DIVERGED || a == FILTRATION_TOO_FAST;
        extreme |= q.odd >= 0 && a == FILTRATION_OK;
        read_all(&s[0], &q, over);
        if (over) break;
        if (a == FILTRATION_BAD_ARGUMENT || a == FILTRATION_BAD_DEF) FUZZ_HOLDS(digest(&s[0]) == before);
        FUZZ_HOLDS(digest(&s[0]) == digest(&s[1]));
        /* interpolation at a solid loses a little, as the header says; half-way bounce-back does not */
        int closed = s[0].spheres.n == 0 && (q.kind == STEP || q.kind == RUN) &&
                     (!def.solid.distance || def.boundary == FILTRATION_HALF_WAY);
        for (int k = 0; k < 6; k++) closed &= def.face[k] != FILTRATION_PRESSURE && def.face[k] != FILTRATION_OUTLET;
        if (closed && !extreme)
            FUZZ_HOLDS(fabs(filtration_fluid_mass(&s[0].fluid) - mass) <=
                       (def.precision == FILTRATION_FLOAT ? 1e-5 : 1e-10) * mass);
        if (q.kind == KEEP_MASS && a == FILTRATION_OK && !extreme)
            FUZZ_HOLDS(fabs(filtration_fluid_mass(&s[0].fluid) / right_mass(&s[0].fluid) - 1.0) <=
                           (def.precision == FILTRATION_FLOAT ? 1e-5 : 1e-9) ||
                       right_mass(&s[0].fluid) == 0.0);
        if (fuzz_one_of(d, 6) == 0) load_in_place(&s[1], &s[0]);
        fuzz_mix_bits(&hash, digest(&s[0]));
    }
    for (int k = 0; k < SIDES; k++) {
        filtration_fluid_free(&s[k].fluid);
        FUZZ_HOLDS(failing_live(&s[k].memory) == 0);
    }
    filtration_bed_free(&body.bed);
    FUZZ_HOLDS(failing_live(&of_solid) == 0);
    return hash;
}

/* ---- the filtration equation ---- */

static void mix_estimate(uint64_t *hash, const filtration_estimate *e) {
    fuzz_mix_number(hash, e->value), fuzz_mix_number(hash, e->error), fuzz_mix_number(hash, e->low),
        fuzz_mix_number(hash, e->high);
}

static uint64_t equation(fuzz_draws *d) {
    enum { READINGS = 14 };
    uint64_t hash = 0xcbf29ce484222325u;
    const call c = draw_call(d, 1, 3), q = draw_call(d, 1, 3);
    filtration_operation o = filtration_operation_default();
    filtration_curve_def def = filtration_curve_default_def();
    filtration_point point;
    filtration_curve curve;
    filtration_estimate estimate;
    double time[READINGS], volume[READINGS], shares[READINGS];
    o.viscosity = number(&c, 0, 5e-4, 2e-3), o.area = number(&c, 1, 0.01, 10.0), o.medium = number(&c, 2, 0.0, 1e11);
    o.product = number(&c, 3, 0.0, 1e13), o.compressibility = c.pick % 2 ? number(&c, 4, 0.0, 0.9) : 0.0;
    o.pressure = number(&c, 5, 1e4, 3e5), o.rate = c.pick % 3 ? HUGE_VAL : number(&c, 6, 1e-6, 1e-3);
    const int sound = filtration_operation_check(&o, NULL) == FILTRATION_OK;
    for (int k = 0; k < 3; k++) {
        const filtration_status status = k == 0   ? filtration_change_over(&o, &point)
                                         : k == 1 ? filtration_at_volume(&o, number(&c, 7, 0.0, 10.0), &point)
                                                  : filtration_at_time(&o, number(&c, 8, 0.0, 1e5), &point);
        FUZZ_HOLDS(status == FILTRATION_OK || status == FILTRATION_BAD_ARGUMENT || status == FILTRATION_NO_SOLUTION);
        FUZZ_HOLDS(sound || status == FILTRATION_BAD_ARGUMENT);
        if (status == FILTRATION_OK && k > 0)
            FUZZ_HOLDS(is_finite(point.time) && point.volume >= 0.0 && point.time >= 0.0);
        if (status == FILTRATION_OK) fuzz_mix_number(&hash, point.volume), fuzz_mix_number(&hash, point.time);
    }
    for (int k = 0; k < READINGS; k++) {
        volume[k] = 1e-4 * (k + 1) * (1.0 + 0.02 * (q.u[k % NUMBERS] - 0.5));
        time[k] = 1e9 * volume[k] * volume[k] + 1e5 * volume[k] * (1.0 + 0.1 * (c.u[k % NUMBERS] - 0.5));
    }
    if (q.odd == 0) time[q.pick % READINGS] = q.value;
    if (q.odd == 1) volume[q.pick % READINGS] = q.value;
    def.pressure = number(&q, 2, 1e4, 1e5), def.viscosity = number(&q, 3, 5e-4, 2e-3),
    def.area = number(&q, 4, 1e-3, 1e-2);
    def.cake_ratio = q.pick % 2 ? number(&q, 5, 0.01, 0.5) : (double)NAN, def.time_error = number(&q, 6, 0.0, 1.0),
    def.volume_error = number(&q, 7, 0.0, 1e-6);
    def.first_volume = number(&q, 8, 0.0, 5e-4), def.last_volume = number(&q, 9, 1e-3, 2e-3),
    def.automatic = q.pick / 2 % 2;
    def.confidence = number(&q, 10, 0.5, 0.99), def.bend_level = number(&q, 11, 0.01, 0.5),
    def.tolerance = number(&q, 12, 0.0, 0.01);
    const filtration_status status = filtration_evaluate(&def, READINGS, time, volume, &curve);
    FUZZ_HOLDS(status != FILTRATION_NO_MEMORY && status < FILTRATION_NOT_STEADY);
    FUZZ_HOLDS((status == FILTRATION_BAD_DEF) == (filtration_curve_check_def(&def, NULL) != FILTRATION_OK));
    if (status == FILTRATION_OK) {
        FUZZ_HOLDS(is_finite(curve.slope.value) && is_finite(curve.intercept.value) && curve.used >= 3);
        mix_estimate(&hash, &curve.slope), mix_estimate(&hash, &curve.product), mix_estimate(&hash, &curve.medium);
        const filtration_status predicted = filtration_predict(
            &curve, number(&q, 13, 1e4, 1e5), number(&q, 14, 0.1, 1.0), number(&q, 15, 0.0, 0.9), 1.0, &estimate);
        FUZZ_HOLDS(predicted == FILTRATION_OK || predicted == FILTRATION_BAD_ARGUMENT ||
                   predicted == FILTRATION_NO_SOLUTION);
        if (predicted == FILTRATION_OK) mix_estimate(&hash, &estimate);
    }
    filtration_evaluate_clean(&def, READINGS, time, volume, number(&q, 9, 1e-4, 1e-3), &estimate);
    for (int k = 0; k < READINGS; k++) shares[k] = number(&c, k, 0.0, 1.0);
    if (filtration_convert_shares(READINGS, volume, shares, number(&c, 14, -3.0, 3.0), shares) == FILTRATION_OK) {
        double sum = 0.0;
        for (int k = 0; k < READINGS; k++) sum += shares[k];
        FUZZ_HOLDS(fabs(sum - 1.0) < 1e-12);
        fuzz_mix_number(&hash, filtration_sauter(READINGS, volume, shares));
    }
    filtration_number_distribution(READINGS, volume, shares, shares);
    fuzz_mix_number(&hash, filtration_contact_sub_steps(NULL, 1.0, 1.0, 1.0));
    fuzz_mix_number(&hash, filtration_lubrication_force(number(&c, 0, 1e-6, 1e-5), number(&c, 1, 1e-6, 1e-5),
                                                        number(&c, 2, -1e-7, 1e-6), number(&c, 3, -1e-3, 1e-3), 1e-3,
                                                        number(&c, 4, 1e-7, 1e-6), number(&c, 5, 1e-9, 1e-8)));
    return hash;
}

static uint64_t run_program(fuzz_draws *d) {
    uint64_t hash = equation(d);
    fuzz_mix_bits(&hash, fluid(d));
    return hash;
}

FUZZ_PROGRAMS(60, 0, 109, 237, 508)
