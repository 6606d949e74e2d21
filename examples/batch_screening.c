/* batch_screening - a batch of glass spheres on a vibrated sieve: the study of Elskamp & Kruggel-Emden (2019).

   1.41 kg of spheres of 5, 7 and 10 mm lie well mixed on the floor of a feed bin. At t = 0 the floor is taken away; they fall onto a
   woven screen with 8 mm apertures that vibrates along an ellipse, and the smaller two classes pass it. Printed and drawn is the
   fraction retained per class over time, for one seed or as mean and interval of several, each a mixture of its own.
   What the paper leaves open (diameter of the deck, drop height, outlet, profile of the bars, damping convention) is an option here;
   docs/batch_screening.md says why the defaults are what they are. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "wet_contact.h"

enum { SMALL, NEAR_MESH, LARGE, CLASSES, UNDERSIZE = 2 };
static const double class_diameter[CLASSES] = {0.005, 0.007, 0.010};
static const char *const class_name[CLASSES] = {"small (5 mm)", "near-mesh (7 mm)", "large (10 mm)"};
static const double GLASS = 2534.1, WATER = 1000.0; /* [kg/m3] */
static const double SAMPLE = 0.1, WATCH = 0.02;     /* between points of the curves, between looks at the layers [s] */

/* ---- input ---- */

typedef struct settings {
    double amplitude, frequency;                                  /* set amplitude [m], [Hz] */
    double time, dt_ratio;                                        /* [s]; contact time over time step */
    double mass, screen_diameter, drop, outlet_delay, exit_depth; /* [kg], [m], [m], [s], [m] */
    double vertical, sideways;                                    /* share of the set amplitude */
    double moisture;                                              /* mass of liquid over mass of particles [-] */
    int profile, restitution, seeds, case_number, laws;
    bool frames, energy;
} settings;

static void choose_case(settings *s, int number) {
    static const double amplitude[3] = {0.8e-3, 1.0e-3, 1.2e-3}, frequency[3] = {45.8, 50.6, 55.4}, moisture[3] = {0.0, 0.025, 0.05};
    s->case_number = number;
    s->moisture = moisture[(number - 1) / 9];
    s->amplitude = amplitude[(number - 1) / 3 % 3];
    s->frequency = frequency[(number - 1) % 3];
}

/* ---- definition ---- */

static dem_def define(const settings *s, int *glass, int *steel) {
    dem_def def = dem_default_def();
    *glass = dem_add_material(&def, GLASS, 5.0e10, 0.2);
    *steel = dem_add_material(&def, 7850.0, 2.08e11, 0.3);
    dem_pair_def *gg = dem_pair(&def, *glass, *glass), *gs = dem_pair(&def, *glass, *steel);
    gg->friction = 0.1966, gg->rolling = 8.95e-5, gg->restitution = 0.7808;
    gs->friction = 0.2866, gs->rolling = 1.09e-4, gs->restitution = 0.4351;
    gg->mode = gs->mode = s->restitution ? DEM_NAIVE : DEM_CLIPPED;
    return def;
}

/* splitmix64 */
static double random_share(uint64_t *state) {
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

typedef struct batch {
    int n;
    double *centre, *diameter; /* [n][3], [n] */
    int *group;                /* [n] */
} batch;

static void free_batch(batch *b) {
    free(b->centre);
    free(b->diameter);
    free(b->group);
    memset(b, 0, sizeof *b);
}

/* One third of the mass of each class, diameters +-0.1 mm, in random order. */
static int mix_batch(batch *b, const settings *s, uint64_t *random) {
    int count[CLASSES], n = 0;
    for (int c = 0; c < CLASSES; c++) {
        const double d = class_diameter[c];
        count[c] = (int)(s->mass / 3.0 / (RIDDLE_PI / 6.0 * d * d * d * GLASS) + 0.5);
        n += count[c];
    }
    b->n = n;
    b->centre = calloc((size_t)n + 1, 3 * sizeof *b->centre);
    b->diameter = calloc((size_t)n + 1, sizeof *b->diameter);
    b->group = calloc((size_t)n + 1, sizeof *b->group);
    if (!b->centre || !b->diameter || !b->group) return -1;
    for (int c = 0, i = 0; c < CLASSES; c++) {
        for (int k = 0; k < count[c]; k++) b->group[i++] = c;
    }
    for (int i = n - 1; i > 0; i--) {
        const int k = (int)(random_share(random) * (i + 1)), t = b->group[i];
        b->group[i] = b->group[k], b->group[k] = t;
    }
    for (int i = 0; i < n; i++) b->diameter[i] = class_diameter[b->group[i]] + 1e-4 * (2.0 * random_share(random) - 1.0);
    return 0;
}

/* ---- state ---- */

/* Mass of the batch [kg]. */
static double batch_mass(const batch *b) {
    double mass = 0.0;
    for (int i = 0; i < b->n; i++) mass += GLASS * RIDDLE_PI / 6.0 * b->diameter[i] * b->diameter[i] * b->diameter[i];
    return mass;
}

/* Places in random order on a grid over the floor of the bin, z = 0, whose solid fraction is 0.4: the large ones overlap. */
static dem_status stack_layers(batch *b, double radius, uint64_t *random) {
    const double pitch = cbrt(batch_mass(b) / GLASS / b->n / 0.4);
    const int reach = (int)(radius / pitch) + 1;
    for (int layer = 0, i = 0; i < b->n; layer++) {
        const int before = i;
        for (int p = -reach; p <= reach; p++) {
            for (int q = -reach; q <= reach && i < b->n; q++) {
                const double x = pitch * p, y = pitch * q, jitter = 0.3 * pitch;
                if (sqrt(x * x + y * y) + 0.5 * pitch > radius) continue;
                b->centre[3 * i] = x + jitter * (2.0 * random_share(random) - 1.0);
                b->centre[3 * i + 1] = y + jitter * (2.0 * random_share(random) - 1.0);
                b->centre[3 * i + 2] = pitch * (layer + 0.5);
                i++;
            }
        }
        if (i == before) return DEM_BAD_ARGUMENT; /* not one sphere fits the bin */
    }
    return DEM_OK;
}

/* Root of the mean square velocity, by mass [m/s]. */
static double rms_speed(const dem_world *world) {
    double mass = 0.0, sum = 0.0;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        const dem_vec v = dem_velocity(world, i);
        mass += world->mass[i];
        sum += world->mass[i] * (v.x * v.x + v.y * v.y + v.z * v.z);
    }
    return mass > 0.0 ? sqrt(sum / mass) : 0.0;
}

/* Lets the batch come to rest on the floor, slower than `quiet` [m/s], with little restitution and a stiffness at which the bed's weight
   makes overlaps of about this share of the diameter, at most the true one: that of 0. Soft spheres are swollen by twice that share, so that the true ones
   just do not overlap; what does at the start is pushed apart without gaining speed. */
static dem_status settle(batch *b, const settings *s, double overlap, double friction, double quiet) {
    enum { PUSHES = 20, PUSH_STEPS = 8, STEPS_PER_CONTACT = 8 };
    const int features = DEM_LINEAR | DEM_FRICTION | DEM_ROLLING;
    const double area = 0.25 * RIDDLE_PI * s->screen_diameter * s->screen_diameter, pressure = 9.81 * batch_mass(b) / area;
    int glass, steel;
    dem_def def = define(s, &glass, &steel);
    const double stiffness = fmin(fmax(pressure * class_diameter[SMALL] / overlap, 200.0), dem_pair(&def, glass, glass)->stiffness);
    dem_world world;
    for (int k = 0; k < 2; k++) {
        dem_pair_def *pair = dem_pair(&def, glass, k ? steel : glass);
        pair->restitution = 0.3, pair->mode = DEM_CLIPPED;
        pair->friction *= friction, pair->rolling *= friction;
        pair->stiffness = stiffness;
    }
    dem_status status = dem_init(&world, &def, NULL);
    for (int i = 0; i < b->n && status == DEM_OK; i++) {
        const double diameter = (1.0 + 2.0 * overlap) * b->diameter[i];
        status = dem_add_spheres(&world, 1, &b->centre[3 * i], &diameter, glass, 0);
    }
    if (status == DEM_OK && dem_add_plane(&world, steel, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) < 0) status = DEM_BAD_ARGUMENT;
    if (status == DEM_OK && dem_add_cylinder(&world, steel, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 0.5 * s->screen_diameter, 1) < 0)
        status = DEM_BAD_ARGUMENT;
    const double dt = dem_advise(&world, DEM_LINEAR, 1.0).contact / STEPS_PER_CONTACT;
    if (status == DEM_OK) status = dem_set_time_step(&world, dt);
    for (int push = 0; push < PUSHES && status == DEM_OK; push++) {
        status = dem_run(&world, PUSH_STEPS * dt, features);
        for (int i = 0; i < b->n && status == DEM_OK; i++) status = dem_set_motion(&world, i, dem_vec3(0, 0, 0), dem_vec3(0, 0, 0));
    }
    double speed = HUGE_VAL;
    while (speed > quiet && world.time < 1.0 && status == DEM_OK && !common_interrupted()) {
        status = dem_run(&world, 0.005, features);
        speed = rms_speed(&world);
    }
    for (int i = 0; i < b->n && status == DEM_OK; i++) {
        const dem_vec x = dem_position(&world, i);
        b->centre[3 * i] = x.x, b->centre[3 * i + 1] = x.y, b->centre[3 * i + 2] = x.z;
    }
    dem_free(&world);
    return status;
}

/* The batch at rest in the bin, from soft spheres in large steps to the true ones. Half the friction at first makes up for the fall of a
   batch that is poured: the solid fraction is that of one that fell from 0.1 m. */
static dem_status fill_bin(batch *b, const settings *s, uint64_t *random) {
    dem_status status = stack_layers(b, 0.5 * s->screen_diameter, random);
    if (status == DEM_OK) status = settle(b, s, 5e-3, 0.5, 0.02);
    if (status == DEM_OK) status = settle(b, s, 2.5e-4, 1.0, 0.01);
    if (status == DEM_OK) status = settle(b, s, 0.0, 1.0, 0.01);
    return status;
}

/* The screen, its side wall, and the plane below at which passage counts; the batch at rest, `drop` above the bars. */
static dem_status build(dem_world *world, const batch *b, const settings *s, int *deck) {
    int glass, steel;
    dem_def def = define(s, &glass, &steel);
    def.dt = 1e-6;
    const char *field;
    dem_status status = dem_init(world, &def, &field);
    if (status != DEM_OK) return status;
    dem_screen screen = dem_default_screen();
    screen.half_x = 0.5 * s->screen_diameter;
    screen.profile = s->profile ? DEM_ROUND : DEM_SEMICIRCLE;
    *deck = dem_add_screen(world, steel, &screen);
    const int wall = dem_add_cylinder(world, steel, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 0.5 * s->screen_diameter, 1);
    const int way_out = dem_add_exit(world, dem_vec3(0, 0, -s->exit_depth), dem_vec3(0, 0, 1));
    if (*deck < 0 || wall < 0 || way_out < 0) status = DEM_BAD_ARGUMENT;
    const dem_vec amplitude = dem_vec3(s->sideways * s->amplitude, 0, s->vertical * s->amplitude), phase = dem_vec3(0.5 * RIDDLE_PI, 0, 0);
    if (status == DEM_OK) status = dem_vibrate(world, *deck, amplitude, phase, s->frequency);
    if (status == DEM_OK) status = dem_vibrate(world, wall, amplitude, phase, s->frequency);
    for (int i = 0; i < b->n && status == DEM_OK; i++) {
        const double centre[3] = {b->centre[3 * i], b->centre[3 * i + 1], b->centre[3 * i + 2] + 0.5 * screen.wire + s->drop};
        status = dem_add_spheres(world, 1, centre, &b->diameter[i], glass, b->group[i]);
    }
    const double dt = dem_advise(world, DEM_LINEAR, 1.0).contact / s->dt_ratio;
    if (status == DEM_OK) status = dem_set_time_step(world, dt);
    return status;
}

/* ---- measurement ---- */

typedef struct result {
    dem_status status;
    int samples;                 /* points of the curves */
    double *retained[UNDERSIZE]; /* [samples], share of the class's mass */
    double *free_share, *occupied_share;
    double top_time[UNDERSIZE]; /* mean time in the top layer [s] */
    double dt, energy_error;
    double liquid_error, bridges_mean, liquid_passed;
    int64_t steps, particle_steps, contact_steps, ruptures;
    uint64_t hash, failed_id;
    dem_wall deck;
} result;

/* Which undersize particles are in the top layer: the body of another stands in their way down to the mesh. Notes the time. */
typedef struct layers {
    int cells, *head, *next;
    double reach, *last_top; /* half width of the map [m]; by id: when last seen in the top layer [s] */
    dem_vec *at;
} layers;

static int layer_cell(const layers *l, double v) {
    return (int)fmin(fmax((v + l->reach) / (2.0 * l->reach) * l->cells, 0.0), l->cells - 1.0);
}

static void watch_layers(layers *l, const dem_world *world, double time) {
    for (int c = 0; c < l->cells * l->cells; c++) l->head[c] = -1;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        if (!world->alive[i]) continue;
        l->at[i] = dem_position(world, i);
        int *head = &l->head[layer_cell(l, l->at[i].y) * l->cells + layer_cell(l, l->at[i].x)];
        l->next[i] = *head;
        *head = (int)i;
    }
    for (ptrdiff_t i = 0; i < world->count; i++) {
        if (!world->alive[i] || world->group[i] >= UNDERSIZE) continue;
        const int x = layer_cell(l, l->at[i].x), y = layer_cell(l, l->at[i].y);
        bool covered = false;
        for (int cy = y > 0 ? y - 1 : 0; cy <= y + 1 && cy < l->cells; cy++) {
            for (int cx = x > 0 ? x - 1 : 0; cx <= x + 1 && cx < l->cells; cx++) {
                for (int k = l->head[cy * l->cells + cx]; k >= 0 && !covered; k = l->next[k]) {
                    const double dx = l->at[k].x - l->at[i].x, dy = l->at[k].y - l->at[i].y, sum = world->radius[i] + world->radius[k];
                    covered = k != (int)i && l->at[k].z < l->at[i].z && l->at[k].z > 0.0 && dx * dx + dy * dy < sum * sum;
                }
            }
        }
        if (covered) l->last_top[world->id[i]] = time;
    }
}

static void free_layers(layers *l) { free(l->head), free(l->next), free(l->last_top), free(l->at); }

static int make_layers(layers *l, int n, double reach) {
    memset(l, 0, sizeof *l);
    l->cells = (int)fmin(fmax(2.0 * reach / 0.0115, 1.0), 1000.0); /* a cell is wider than two bodies can reach */
    l->reach = reach;
    l->head = malloc((size_t)(l->cells * l->cells) * sizeof *l->head);
    l->next = malloc(((size_t)n + 1) * sizeof *l->next);
    l->last_top = calloc((size_t)n + 1, sizeof *l->last_top);
    l->at = malloc(((size_t)n + 1) * sizeof *l->at);
    return l->head && l->next && l->last_top && l->at ? 0 : -1;
}

/* Mass of a class, particles and their liquid, that has not reached the outlet's end at a time, over the mass at the start. */
static double retained(const dem_world *world, const batch *b, const wet_scene *wet, double film, int group, double time, double delay) {
    double whole = 0.0, gone = 0.0;
    for (int i = 0; i < b->n; i++) {
        const double d = b->diameter[i];
        if (b->group[i] == group) whole += GLASS * RIDDLE_PI / 6.0 * d * d * d + WATER * film * RIDDLE_PI * d * d;
    }
    for (ptrdiff_t k = 0; k < world->passed_count; k++) {
        const dem_passed *p = &world->passed[k];
        if (p->group != group || p->time + delay > time + 1e-9) continue;
        gone += GLASS * RIDDLE_PI / 6.0 * p->diameter * p->diameter * p->diameter + (wet ? WATER * wet->films.particle[p->id] : 0.0);
    }
    return whole > 0.0 ? 1.0 - gone / whole : 0.0;
}

static void write_frame(const dem_world *world, const char *folder, pvd *series, double time) {
    const ptrdiff_t n = world->count;
    double *buffer = malloc((size_t)(7 * n + 1) * sizeof *buffer);
    int *group = malloc((size_t)(n + 1) * sizeof *group), m = 0;
    if (buffer && group) {
        double *x = buffer, *v = buffer + 3 * n, *d = buffer + 6 * n;
        for (ptrdiff_t i = 0; i < n; i++) {
            if (!world->alive[i]) continue;
            const dem_vec at = dem_position(world, i), u = dem_velocity(world, i);
            x[3 * m] = at.x, x[3 * m + 1] = at.y, x[3 * m + 2] = at.z;
            v[3 * m] = u.x, v[3 * m + 1] = u.y, v[3 * m + 2] = u.z;
            d[m] = 2.0 * world->radius[i];
            group[m++] = world->group[i];
        }
        const vtk_array arrays[] = {vtk_scalar("diameter_m", d), vtk_vector("velocity_m_s", v), vtk_ints("class", group)};
        vtp_points(folder, pvd_name(series, time), m, vtk_vector("position", x), arrays, 3);
    } else common_fail("out of memory for a frame");
    free(buffer);
    free(group);
}

/* ---- one run ---- */

typedef struct study {
    settings set;
    settings *variants; /* [variants]; the first is `set` */
    int variant_count;
    uint64_t seed;
    result *results; /* [variants][seeds] */
    progress *bar;
    pvd *series;
    const char *out;
} study;

static int run_seed(int index, void *user) {
    study *st = user;
    const settings *s = &st->variants[index / st->set.seeds];
    result *r = &st->results[index];
    uint64_t random = st->seed + (uint64_t)(index % st->set.seeds);
    batch b;
    dem_world world;
    wet_scene *wet = NULL;
    double film = 0.0, glass = 0.0, area = 0.0; /* thickness [m], mass [kg], surface [m2] */
    int deck = 0, looks = 0;
    memset(&b, 0, sizeof b);
    memset(&world, 0, sizeof world);
    r->status = mix_batch(&b, s, &random) ? DEM_OUT_OF_MEMORY : fill_bin(&b, s, &random);
    if (r->status == DEM_OK && !common_interrupted()) r->status = build(&world, &b, s, &deck);
    for (int i = 0; i < b.n; i++) {
        glass += GLASS * RIDDLE_PI / 6.0 * b.diameter[i] * b.diameter[i] * b.diameter[i];
        area += RIDDLE_PI * b.diameter[i] * b.diameter[i];
    }
    if (r->status == DEM_OK && s->moisture > 0.0) {
        film = s->moisture * glass / WATER / area;
        wet = malloc(sizeof *wet);
        if (!wet) r->status = DEM_OUT_OF_MEMORY;
        else if (wet_init(wet, b.n, b.group, b.diameter, class_diameter, s->moisture, glass, deck, &world, s->laws == 1) != BRIDGE_OK)
            r->status = DEM_BAD_ARGUMENT;
        world.user = wet;
    }

    const int n = b.n, features = DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | (s->energy && !wet ? DEM_ENERGY : 0);
    const int watches = (int)(s->time / WATCH + 0.5), every = (int)(SAMPLE / WATCH + 0.5);
    const double arrival = sqrt(2.0 * s->drop / 9.81);
    layers bed;
    if (make_layers(&bed, n, 0.5 * s->screen_diameter) && r->status == DEM_OK) r->status = DEM_OUT_OF_MEMORY;
    for (int k = 0; k <= watches && r->status == DEM_OK && !common_interrupted(); k++) {
        const double time = k * WATCH;
        if (k > 0) r->status = wet ? wet_run(&world, WATCH) : dem_run(&world, WATCH, features);
        if (time >= arrival && r->status == DEM_OK) watch_layers(&bed, &world, time);
        if (k % every == 0) {
            const int sample = k / every;
            const dem_apertures holes = dem_count_apertures(&world, deck);
            for (int c = 0; c < UNDERSIZE; c++) r->retained[c][sample] = retained(&world, &b, wet, film, c, time, s->outlet_delay);
            r->free_share[sample] = holes.total ? (double)holes.free / holes.total : 1.0;
            r->occupied_share[sample] = holes.total ? (double)holes.occupied / holes.total : 0.0;
            r->samples = sample + 1;
            if (wet) {
                int bridges;
                const double total = wet_total(wet, &world, &bridges);
                r->liquid_error = fmax(r->liquid_error, fabs(total / wet->initial - 1.0));
                r->bridges_mean += bridges;
                looks++;
            }
        }
        if (st->series && index == 0 && k % every == 0) write_frame(&world, st->out, st->series, time);
        progress_add(st->bar, WATCH);
    }
    if (r->status == DEM_OK) {
        double sum[UNDERSIZE] = {0.0, 0.0};
        int count[UNDERSIZE] = {0, 0};
        for (int i = 0; i < n; i++) { /* the bottom layer from the next look on, unless it passed before; never in it: to the end */
            if (b.group[i] >= UNDERSIZE) continue;
            sum[b.group[i]] += fmin(fmax(bed.last_top[i] + WATCH - arrival, 0.0), s->time);
            count[b.group[i]]++;
        }
        for (ptrdiff_t k = 0; k < world.passed_count; k++) {
            const dem_passed *p = &world.passed[k];
            if (p->group < UNDERSIZE && p->time < bed.last_top[p->id] + WATCH) sum[p->group] -= bed.last_top[p->id] + WATCH - p->time;
        }
        for (int c = 0; c < UNDERSIZE; c++) r->top_time[c] = count[c] ? sum[c] / count[c] : 0.0;
        const dem_energy_ledger e = dem_energy(&world);
        r->energy_error = s->energy && !wet ? fabs(e.error) / (fabs(e.wall_work) + e.released + fabs(e.start)) : (double)NAN;
        r->dt = world.def.dt;
        r->steps = world.step;
        r->particle_steps = world.particle_steps;
        r->contact_steps = world.contact_steps;
        r->hash = dem_hash(&world);
        if (wet) {
            r->bridges_mean /= looks;
            r->ruptures = wet->ruptures;
            for (ptrdiff_t k = 0; k < world.passed_count; k++) r->liquid_passed += WATER * wet->films.particle[world.passed[k].id];
        }
    }
    r->failed_id = world.failed_id;
    free_layers(&bed);
    if (wet) wet_free(wet);
    free(wet);
    free_batch(&b);
    dem_free(&world);
    return r->status != DEM_OK;
}

/* ---- output ---- */

/* Mean and standard deviation over the seeds at each sample. */
static void average(const result *r, int seeds, int samples, size_t curve, double *mean, double *sd) {
    for (int k = 0; k < samples; k++) {
        double sum = 0.0, square = 0.0;
        for (int q = 0; q < seeds; q++) {
            const double *const curves[] = {r[q].retained[0], r[q].retained[1], r[q].free_share, r[q].occupied_share};
            sum += curves[curve][k];
        }
        mean[k] = sum / seeds;
        for (int q = 0; q < seeds; q++) {
            const double *const curves[] = {r[q].retained[0], r[q].retained[1], r[q].free_share, r[q].occupied_share};
            square += (curves[curve][k] - mean[k]) * (curves[curve][k] - mean[k]);
        }
        sd[k] = seeds > 1 ? sqrt(square / (seeds - 1)) : 0.0;
    }
}

/* Two-sided 95 % quantile of Student's t; the tabulated values of any textbook. */
static double student(int freedom) {
    static const double t[] = {0,     12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
                               2.201, 2.179,  2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086, 2.080,
                               2.074, 2.069,  2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042};
    return freedom < 1 ? 0.0 : freedom <= 30 ? t[freedom] : 1.96 + 2.4 / freedom;
}

static void draw(const study *st, int samples, const double *time, double *const *mean, double *const *sd) {
    const settings *s = &st->set;
    char title[120];
    double *low = malloc((size_t)samples * 2 * sizeof *low), *high = low ? low + samples : NULL;
    if (!low) return;
    char moisture[32] = "dry";
    if (s->moisture > 0.0) snprintf(moisture, sizeof moisture, "%.3g %% water", 100.0 * s->moisture);
    snprintf(title, sizeof title, "%.3g mm, %.3g Hz, %s, %d seed%s", 1e3 * s->amplitude, s->frequency, moisture, s->seeds,
             s->seeds > 1 ? "s" : "");
    plot *figure = plot_new(title, 1, 1);
    plot_panel(figure, 0, 0, "time [s]", "fraction retained [-]");
    plot_range_y(figure, 0.0, 1.02);
    for (int c = 0; c < UNDERSIZE; c++) {
        const double t = student(s->seeds - 1) / sqrt((double)s->seeds);
        plot_line(figure, class_name[c], time, mean[c], samples);
        if (s->seeds < 2) continue;
        for (int k = 0; k < samples; k++) low[k] = fmax(mean[c][k] - t * sd[c][k], 0.0), high[k] = fmin(mean[c][k] + t * sd[c][k], 1.0);
        plot_band(figure, NULL, time, low, high, samples);
        plot_style(figure, 0, PLOT_SAME);
    }
    if (s->case_number == 5 && s->moisture == 0.0) { /* numbers in the text of section 5.1 */
        const double at[] = {5.0, 10.0}, small[] = {0.13, 0.015}, near_mesh[] = {0.20, 0.10};
        const int n = s->time >= 10.0 ? 2 : s->time >= 5.0 ? 1 : 0;
        if (n) plot_points(figure, "paper, small", at, small, n), plot_style(figure, 0, 0);
        if (n) plot_points(figure, "paper, near-mesh", at, near_mesh, n), plot_style(figure, 0, 1);
    }
    plot_write(figure, st->out, "retained.svg");
    figure = plot_new("Apertures of the screen", 1, 1);
    plot_panel(figure, 0, 0, "time [s]", "share of apertures [-]");
    plot_range_y(figure, 0.0, 1.02);
    plot_line(figure, "free (none wedged)", time, mean[2], samples);
    plot_line(figure, "a particle sits in it", time, mean[3], samples);
    plot_write(figure, st->out, "apertures.svg");
    free(low);
}

static void report(const program *self, const study *st, int samples, double wall) {
    const settings *s = &st->set;
    const result *r = st->results;
    double *time = malloc((size_t)samples * 9 * sizeof *time), *mean[4], *sd[4], top[UNDERSIZE] = {0, 0}, error = 0.0, steps = 0,
           particle_steps = 0, contact_steps = 0;
    if (!time) {
        common_fail("out of memory");
        return;
    }
    for (int k = 0; k < samples; k++) time[k] = k * SAMPLE;
    for (size_t c = 0; c < 4; c++) {
        mean[c] = time + (size_t)samples * (1 + 2 * c);
        sd[c] = mean[c] + samples;
        average(r, s->seeds, samples, c, mean[c], sd[c]);
    }
    for (int q = 0; q < s->seeds; q++) {
        for (int c = 0; c < UNDERSIZE; c++) top[c] += r[q].top_time[c] / s->seeds;
        error = fmax(error, r[q].energy_error);
        steps += (double)r[q].steps, particle_steps += (double)r[q].particle_steps, contact_steps += (double)r[q].contact_steps;
    }

    const double t = s->seeds > 1 ? student(s->seeds - 1) / sqrt((double)s->seeds) : 0.0;
    table rows = table_begin(s->seeds > 1 ? "time [s]|small retained|+- 95 %|near-mesh retained|+- 95 %|apertures free"
                                          : "time [s]|small retained|near-mesh retained|apertures free");
    for (int k = 0; k < samples; k += (int)(fmax(1.0, floor(s->time / 10.0 + 0.5)) / SAMPLE + 0.5)) {
        table_cell(&rows, "%.1f", time[k]);
        for (int c = 0; c < UNDERSIZE; c++) {
            table_cell(&rows, "%.3f", mean[c][k]);
            if (s->seeds > 1) table_cell(&rows, "%.3f", t * sd[c][k]);
        }
        table_cell(&rows, "%.3f", mean[2][k]);
    }
    table_end(&rows);
    common_print("mean time in the top layer: small %.2f s, near-mesh %.2f s\n", top[SMALL], top[NEAR_MESH]);
    common_print("%.3g steps of %.3g us, %.3g particle-steps, %.3g contact-steps in %.1f s\n", steps, 1e6 * r[0].dt, particle_steps,
                 contact_steps, wall);
    if (s->moisture > 0.0)
        common_print("liquid conserved to %.1e; %.0f bridges on average, %lld ruptures (first seed)\n", r[0].liquid_error,
                     r[0].bridges_mean, (long long)r[0].ruptures);
    else if (s->energy) common_print("energy ledger closes to %.1e of work, released potential and initial energy\n", error);

    draw(st, samples, time, mean, sd);
    csv *curves =
        csv_open(st->out, "retained.csv",
                 "time_s,retained_small,retained_small_sd,retained_near_mesh,retained_near_mesh_sd,free_fraction,occupied_fraction");
    for (int k = 0; k < samples; k++)
        csv_row(curves, (const double[]){time[k], mean[0][k], sd[0][k], mean[1][k], sd[1][k], mean[2][k], mean[3][k]}, 7);
    csv_close(curves);

    json *j = json_open(self->json);
    json_program(j, self);
    json_integer(j, "case", s->case_number);
    json_number(j, "amplitude_m", s->amplitude);
    json_number(j, "frequency_hz", s->frequency);
    json_number(j, "moisture", s->moisture);
    json_number(j, "screen_diameter_m", s->screen_diameter);
    json_number(j, "drop_height_m", s->drop);
    json_number(j, "outlet_delay_s", s->outlet_delay);
    json_number(j, "dt_s", r[0].dt);
    json_array(j, "time_s", time, samples);
    json_array(j, "retained_small", mean[SMALL], samples);
    json_array(j, "retained_near_mesh", mean[NEAR_MESH], samples);
    if (s->seeds > 1) {
        json_array(j, "retained_small_sd", sd[SMALL], samples);
        json_array(j, "retained_near_mesh_sd", sd[NEAR_MESH], samples);
    }
    json_number(j, "top_layer_time_small_s", top[SMALL]);
    json_number(j, "top_layer_time_near_mesh_s", top[NEAR_MESH]);
    json_array(j, "free_fraction", mean[2], samples);
    json_array(j, "occupied_fraction", mean[3], samples);
    json_integer(j, "seeds", s->seeds);
    json_number(j, "steps", steps);
    json_number(j, "particle_steps", particle_steps);
    json_number(j, "contact_steps", contact_steps);
    json_number(j, "energy_error_rel", s->energy && s->moisture == 0.0 ? error : (double)NAN);
    if (s->moisture > 0.0) {
        double liquid = 0.0, bridges = 0.0, ruptures = 0.0, passed[64];
        for (int q = 0; q < s->seeds; q++) {
            liquid = fmax(liquid, r[q].liquid_error);
            bridges += r[q].bridges_mean / s->seeds, ruptures += (double)r[q].ruptures / s->seeds;
            if (q < 64) passed[q] = r[q].liquid_passed;
        }
        json_string(j, "laws", s->laws ? "printed" : "corrected");
        json_number(j, "liquid_error_rel", liquid);
        json_number(j, "bridges_mean", bridges);
        json_number(j, "ruptures", ruptures);
        json_array(j, "liquid_passed_kg", passed, s->seeds < 64 ? s->seeds : 64);
    }
    json_bool(j, "deterministic_build", dem_build_is_deterministic());
    char hash[20];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)r[0].hash);
    json_string(j, "hash_first_seed", hash);
    json_close(j);
    free(time);
}

static int make_results(study *st, int samples) {
    const int runs = st->variant_count * st->set.seeds;
    st->results = calloc((size_t)runs, sizeof *st->results);
    if (!st->results) return -1;
    for (int q = 0; q < runs; q++) {
        double *block = calloc((size_t)samples, 4 * sizeof *block);
        if (!block) return -1;
        for (int c = 0; c < UNDERSIZE; c++) st->results[q].retained[c] = block + (size_t)c * (size_t)samples;
        st->results[q].free_share = block + 2 * (size_t)samples;
        st->results[q].occupied_share = block + 3 * (size_t)samples;
    }
    return 0;
}

/* ---- sensitivity: what the paper leaves open, one thing at a time ---- */

enum { VARIANTS = 13 };
static const char *const variant_name[VARIANTS] = {"default",        "deck 185 mm",   "deck 195 mm",  "deck 200 mm", "drop 10 mm",
                                                   "drop 60 mm",     "outlet 0.25 s", "outlet 1.0 s", "round bars",  "no sideways",
                                                   "vertical 1.0 A", "naive damping", "half step"};

static void vary(const settings *base, settings *all) {
    for (int k = 0; k < VARIANTS; k++) all[k] = *base;
    all[1].screen_diameter = 0.185, all[2].screen_diameter = 0.195, all[3].screen_diameter = 0.200;
    all[4].drop = 0.010, all[5].drop = 0.060;
    all[6].outlet_delay = 0.25, all[7].outlet_delay = 1.0;
    all[8].profile = 1;
    all[9].sideways = 0.0, all[10].vertical = 1.0;
    all[11].restitution = 1;
    all[12].dt_ratio = 2.0 * base->dt_ratio;
}

static void report_sensitivity(const study *st) {
    const int seeds = st->set.seeds;
    const double when[2] = {5.0, 10.0}, paper[2][UNDERSIZE] = {{0.13, 0.20}, {0.015, 0.10}};
    const char *heading[2] = {"after 5 s", "after 10 s"};
    plot *figure = plot_new("What the paper leaves open, one at a time: dry initial case", 2, 1);
    csv *rows = csv_open(st->out, "sensitivity.csv", "variant,time_s,small,small_sd,near_mesh,near_mesh_sd,seeds");
    table t = table_begin("variant|time [s]|small|sd|near-mesh|sd");
    for (int w = 0; w < 2; w++) {
        double mean[UNDERSIZE][VARIANTS], sd[UNDERSIZE][VARIANTS];
        for (int v = 0; v < VARIANTS; v++) {
            for (int c = 0; c < UNDERSIZE; c++) {
                double sum = 0.0, square = 0.0;
                for (int q = 0; q < seeds; q++) sum += st->results[v * seeds + q].retained[c][(int)(when[w] / SAMPLE + 0.5)] / seeds;
                for (int q = 0; q < seeds; q++) {
                    const double d = st->results[v * seeds + q].retained[c][(int)(when[w] / SAMPLE + 0.5)] - sum;
                    square += d * d;
                }
                mean[c][v] = sum, sd[c][v] = seeds > 1 ? sqrt(square / (seeds - 1)) : 0.0;
            }
            csv_line(rows, "%s,%g,%.6f,%.6f,%.6f,%.6f,%d", variant_name[v], when[w], mean[0][v], sd[0][v], mean[1][v], sd[1][v], seeds);
            table_cell(&t, "%s", variant_name[v]), table_cell(&t, "%.0f", when[w]);
            for (int c = 0; c < UNDERSIZE; c++) table_cell(&t, "%.3f", mean[c][v]), table_cell(&t, "%.3f", sd[c][v]);
        }
        plot_panel(figure, w, 0, "", "fraction retained [-]");
        plot_title(figure, heading[w]);
        for (int c = 0; c < UNDERSIZE; c++) plot_bars(figure, class_name[c], variant_name, mean[c], VARIANTS);
        plot_horizontal(figure, "paper, small", paper[w][SMALL]);
        plot_horizontal(figure, "paper, near-mesh", paper[w][NEAR_MESH]);
    }
    plot_panel_size(figure, 980, 300);
    table_end(&t);
    csv_close(rows);
    plot_write(figure, st->out, "sensitivity.svg");
}

int main(int argc, char **argv) {
    study st = {0};
    settings *s = &st.set;
    settings variants[VARIANTS];
    double amplitude_mm = 1.0, frequency_hz = 50.6, diameter_mm = 190.0, drop_mm = 30.0, moisture = 0.0;
    bool no_frames = false, no_energy = false, sensitivity = false;
    int number = 5;
    s->time = 20.0, s->dt_ratio = 20.0, s->mass = 1.41, s->outlet_delay = 0.5, s->exit_depth = 0.012, s->vertical = 0.9, s->sideways = 0.1,
    s->seeds = 1;
    option options[] = {
        option_int("case", "N", &number, 1, 27, "case of table 5 of the paper: 1-9 dry, 10-18 with 2.5 %, 19-27 with 5 % of water"),
        option_double("amplitude-mm", "MM", &amplitude_mm, 0.0, 5.0, "set amplitude [mm], instead of a case"),
        option_double("frequency-hz", "HZ", &frequency_hz, 0.0, 200.0, "frequency [Hz], instead of a case"),
        option_double("moisture", "SHARE", &moisture, 0.0, 0.08, "mass of water over mass of particles [-], instead of the case's"),
        option_choice("laws", &s->laws, "corrected|printed", "liquid bridges by Young-Laplace, or by eqs 12-18 as printed"),
        option_positive("time", "S", &s->time, 1e4, "simulated time [s]"),
        option_int("seeds", "N", &s->seeds, 1, 10000, "independent mixtures, one per core; mean and interval"),
        option_double("screen-diameter-mm", "MM", &diameter_mm, 50.0, 2000.0, "clear diameter of the deck [mm]"),
        option_double("drop-mm", "MM", &drop_mm, 1.0, 500.0, "height of the bin's floor over the bars [mm]"),
        option_double("outlet-delay", "S", &s->outlet_delay, 0.0, 10.0, "time from the screen to the end of the outlet [s]"),
        option_double("sideways", "SHARE", &s->sideways, 0.0, 1.0, "horizontal over set amplitude [-]"),
        option_double("vertical", "SHARE", &s->vertical, 0.0, 2.0, "vertical over set amplitude [-]"),
        option_double("mass", "KG", &s->mass, 0.005, 1000.0, "mass of the batch [kg]"),
        option_choice("profile", &s->profile, "semicircle|round", "section of the bars"),
        option_choice("restitution", &s->restitution, "clipped|naive", "how damping follows from the coefficient of restitution"),
        option_double("steps-per-contact", "N", &s->dt_ratio, 8.0, 1000.0, "duration of the shortest contact over the time step [-]"),
        option_flag("no-frames", &no_frames, "no .vtp series"),
        option_flag("no-energy", &no_energy, "no energy ledger"),
        option_flag("sensitivity", &sensitivity, "vary what the paper leaves open, one thing at a time, --seeds runs each; 10 s"),
    };
    program self =
        program_start("batch_screening",
                      "Glass spheres of 5, 7 and 10 mm on a vibrated sieve with 8 mm apertures, dry or wet (Elskamp & Kruggel-Emden 2019).",
                      options, sizeof options / sizeof *options, argc, argv);
    if (options[0].given && (options[1].given || options[2].given))
        program_refuse(&self, "case", NULL, "not together with --amplitude-mm or --frequency-hz");
    choose_case(s, number);
    if (options[1].given || options[2].given) s->case_number = 0, s->amplitude = 1e-3 * amplitude_mm, s->frequency = frequency_hz;
    if (options[3].given) s->moisture = moisture, s->case_number = 0;
    if (self.quick && !options[5].given) s->time = 0.5;
    if (self.quick) s->mass = fmin(s->mass, 0.3);
    s->screen_diameter = 1e-3 * diameter_mm;
    s->drop = 1e-3 * drop_mm;
    s->energy = !no_energy;
    s->frames = !no_frames;
    st.seed = self.seed * 1000003u;
    st.out = self.out;
    if (sensitivity) s->time = 10.0, s->frames = s->energy = false;
    variants[0] = *s;
    if (sensitivity) vary(s, variants);
    st.variants = variants;
    st.variant_count = sensitivity ? VARIANTS : 1;

    const int runs = st.variant_count * s->seeds;
    progress bar;
    const int samples = (int)(s->time / SAMPLE + 1e-9) + 1;
    const double started = machine_seconds();
    if (make_results(&st, samples)) {
        common_fail("out of memory for %d seeds of %d samples", s->seeds, samples);
        return common_exit_status();
    }
    if (s->frames) st.series = pvd_open(self.out, "particles.pvd");
    progress_begin(&bar, "screening", s->time * runs);
    st.bar = &bar;
    jobs_run(runs, self.threads, run_seed, &st);
    progress_end(&bar);
    if (st.series) pvd_close(st.series);
    for (int q = 0; q < runs && !common_interrupted(); q++) {
        if (st.results[q].status != DEM_OK)
            common_fail("run %d: %s (particle %llu)", q + 1, dem_status_text(st.results[q].status),
                        (unsigned long long)st.results[q].failed_id);
    }
    if (!common_interrupted() && common_exit_status() == 0) {
        if (sensitivity) report_sensitivity(&st);
        else report(&self, &st, samples, machine_seconds() - started);
    }
    for (int q = 0; q < runs; q++) free(st.results[q].retained[0]);
    free(st.results);
    return common_exit_status();
}
