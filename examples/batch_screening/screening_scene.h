/* screening_scene.h - the scenes of the batch-screening study of Elskamp & Kruggel-Emden (2019), and what is measured
   in them.

   run_scene() mixes a batch, lets it settle, lets it go and fills a result: the batch on a vibrated screen (sections 4
   and 5.1 of the paper), the batch on a closed vibrated plate, and a quarter of it on the screen (both section 5.2). */
#ifndef SCREENING_SCENE_H
#define SCREENING_SCENE_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "world_picture.h"
#include "dem_wet.h"

enum { SMALL, NEAR_MESH, LARGE, CLASSES, UNDERSIZE = 2 };
static const double class_diameter[CLASSES] = {0.005, 0.007, 0.010};
static const char *const class_name[CLASSES] = {"small (5 mm)", "near-mesh (7 mm)", "large (10 mm)"};
static const double GLASS = 2534.1, WATER = 1000.0; /* [kg/m3] */
static const double SAMPLE = 0.1, WATCH = 0.02;     /* between points of the curves, between looks at the layers [s] */

/* ---- input ---- */

typedef enum scene_kind { SCENE_SCREEN, SCENE_CLOSED_PLATE, SCENE_THIN_LAYER } scene_kind;

typedef struct settings {
    double amplitude, frequency;                                  /* set amplitude [m], [Hz] */
    double time, dt_ratio;                                        /* [s]; contact time over time step */
    double mass, screen_diameter, drop, outlet_delay, exit_depth; /* [kg], [m], [m], [s], [m] */
    double vertical, sideways;                                    /* share of the set amplitude */
    double moisture;                                              /* mass of liquid over mass of particles [-] */
    int scene, profile, restitution, laws;                        /* scene_kind; indices of the options' choices */
    int walls, outlet;                                            /* side wall of steel or PVC; outlet as a delay
                                                                     or as a wall */
    int case_number;                                              /* of table 5; 0: none of them */
    bool energy;
} settings;

/* What a run depends on, so that a run that was written can be told from another: name in its file, value. */
#define SETTINGS_OF_A_RUN(X)                                                                                           \
    X("amplitude_m", s->amplitude)                                                                                     \
    X("frequency_hz", s->frequency)                                                                                    \
    X("moisture", s->moisture)                                                                                         \
    X("laws", s->laws)                                                                                                 \
    X("scene", s->scene)                                                                                               \
    X("time_s", s->time)                                                                                               \
    X("steps_per_contact", s->dt_ratio)                                                                                \
    X("mass_kg", s->mass)                                                                                              \
    X("screen_diameter_m", s->screen_diameter)                                                                         \
    X("drop_m", s->drop)                                                                                               \
    X("outlet_delay_s", s->outlet_delay)                                                                               \
    X("exit_depth_m", s->exit_depth)                                                                                   \
    X("vertical", s->vertical)                                                                                         \
    X("sideways", s->sideways)                                                                                         \
    X("profile", s->profile)                                                                                           \
    X("restitution", s->restitution)                                                                                   \
    X("side_wall", s->walls)                                                                                           \
    X("outlet_wall", s->outlet)
#define SETTING_NAME(name, value) name,
#define SETTING_VALUE(name, value) (double)(value),
static const char *const setting_name[] = {SETTINGS_OF_A_RUN(SETTING_NAME)};
enum { SETTINGS = sizeof setting_name / sizeof *setting_name };
static void list_settings(const settings *s, double *row) {
    const double all[SETTINGS] = {SETTINGS_OF_A_RUN(SETTING_VALUE)};
    memcpy(row, all, sizeof all);
}

/* Table 5 of the paper: 1-9 dry, 10-18 with 2.5 %, 19-27 with 5 % of water. */
enum { CASES = 27 };
static const double case_amplitude[3] = {0.8e-3, 1.0e-3, 1.2e-3}, case_frequency[3] = {45.8, 50.6, 55.4},
                    case_moisture[3] = {0.0, 0.025, 0.05};

static void choose_case(settings *s, int number) {
    s->case_number = number;
    s->moisture = case_moisture[(number - 1) / 9];
    s->amplitude = case_amplitude[(number - 1) / 3 % 3];
    s->frequency = case_frequency[(number - 1) % 3];
}

/* ---- definition ---- */

enum { GLASS_SPHERE, STEEL_WALL, PVC_WALL }; /* materials, in the order of table 2 of the paper */

/* Tables 2 and 4. For PVC the paper prints no contact parameters: it has those of steel. */
static dem_def define(const settings *s) {
    dem_def def = dem_default_def();
    def.allocator.fn = machine_resize;
    dem_add_material(&def, GLASS, 5.0e10, 0.2);
    dem_add_material(&def, 7850.0, 2.08e11, 0.3);
    dem_add_material(&def, 1300.0, 2.2e9, 0.4);
    for (int k = GLASS_SPHERE; k <= PVC_WALL; k++) {
        dem_pair_def *pair = dem_pair(&def, GLASS_SPHERE, k);
        pair->friction = k ? 0.2866 : 0.1966, pair->rolling = k ? 1.09e-4 : 8.95e-5,
        pair->restitution = k ? 0.4351 : 0.7808;
        pair->mode = s->restitution ? DEM_NAIVE : DEM_CLIPPED;
    }
    return def;
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

/* Classes in random order: any, as they are poured; or evenly, so that every part of the order holds the
   classes' shares. */
static void order_at_random(int *group, int n, const int *count, uint64_t *random) {
    for (int c = 0, i = 0; c < CLASSES; c++)
        for (int k = 0; k < count[c]; k++) group[i++] = c;
    for (int i = n - 1; i > 0; i--) {
        const int k = (int)(random_share(random) * (i + 1)), t = group[i];
        group[i] = group[k], group[k] = t;
    }
}
static void order_evenly(int *group, int n, const int *count, uint64_t *random) {
    double turn[CLASSES]; /* the k-th of a class comes somewhere in the k-th part of the order */
    int placed[CLASSES] = {0};
    for (int c = 0; c < CLASSES; c++) turn[c] = count[c] ? random_share(random) / count[c] : HUGE_VAL;
    for (int i = 0; i < n; i++) {
        int next = 0;
        for (int c = 1; c < CLASSES; c++)
            if (turn[c] < turn[next]) next = c;
        group[i] = next;
        turn[next] = ++placed[next] < count[next] ? (placed[next] + random_share(random)) / count[next] : HUGE_VAL;
    }
}

/* Spheres of a class; each class has a third of the mass. */
static double class_spheres(const settings *s, int class) {
    const double d = class_diameter[class];
    return floor(s->mass / 3.0 / (RIDDLE_PI / 6.0 * d * d * d * GLASS) + 0.5);
}

static double batch_spheres(const settings *s) {
    return class_spheres(s, SMALL) + class_spheres(s, NEAR_MESH) + class_spheres(s, LARGE);
}

/* Diameters +-0.1 mm. */
static int mix_batch(batch *b, const settings *s, uint64_t *random) {
    int count[CLASSES], n = 0;
    for (int c = 0; c < CLASSES; c++) {
        count[c] = (int)class_spheres(s, c);
        n += count[c];
    }
    b->n = n;
    b->centre = calloc((size_t)n + 1, 3 * sizeof *b->centre);
    b->diameter = calloc((size_t)n + 1, sizeof *b->diameter);
    b->group = calloc((size_t)n + 1, sizeof *b->group);
    if (!b->centre || !b->diameter || !b->group) return -1;
    if (s->scene == SCENE_SCREEN) order_at_random(b->group, n, count, random);
    else order_evenly(b->group, n, count, random);
    for (int i = 0; i < n; i++)
        b->diameter[i] = class_diameter[b->group[i]] + 1e-4 * (2.0 * random_share(random) - 1.0);
    return 0;
}

/* ---- state ---- */

/* Mass of the batch [kg]. */
static double batch_mass(const batch *b) {
    double mass = 0.0;
    for (int i = 0; i < b->n; i++) mass += GLASS * RIDDLE_PI / 6.0 * b->diameter[i] * b->diameter[i] * b->diameter[i];
    return mass;
}

/* Fills a grid over the floor, z = 0, layer by layer to a solid fraction; 0.12 is just not too dense for
   the large ones. */
static dem_status stack_layers(batch *b, double radius, double solid, uint64_t *random) {
    const double pitch = cbrt(batch_mass(b) / GLASS / b->n / solid);
    const int reach = (int)(radius / pitch) + 1;
    for (int layer = 0, i = 0; i < b->n; layer++) {
        const int before = i;
        for (int p = -reach; p <= reach; p++) {
            for (int q = -reach; q <= reach && i < b->n; q++) {
                const double x = pitch * p, y = pitch * q, jitter = 0.35 * fmax(pitch - b->diameter[i], 0.0);
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
        mass += dem_mass(world, i);
        sum += dem_mass(world, i) * (v.x * v.x + v.y * v.y + v.z * v.z);
    }
    return mass > 0.0 ? sqrt(sum / mass) : 0.0;
}

/* Lets the batch come to rest on the floor, slower than `quiet` [m/s] (infinite: as soon as it is pushed apart), with
   little restitution and a stiffness at which the bed's weight makes overlaps of about this share of the diameter, at
   most the true one: that of 0. Soft spheres are swollen by twice that share, so that the true ones just do not
   overlap; what does at the start is pushed apart without gaining speed. */
static dem_status settle(batch *b, const settings *s, double overlap, double quiet) {
    enum { PUSHES = 20, PUSH_STEPS = 8, STEPS_PER_CONTACT = 8 };
    const int features = DEM_LINEAR | DEM_FRICTION | DEM_ROLLING;
    const double area = 0.25 * RIDDLE_PI * s->screen_diameter * s->screen_diameter,
                 pressure = 9.81 * batch_mass(b) / area;
    const int glass = GLASS_SPHERE, steel = STEEL_WALL;
    dem_def def = define(s);
    const double stiffness =
        fmin(fmax(pressure * class_diameter[SMALL] / overlap, 200.0), dem_pair(&def, glass, glass)->stiffness);
    dem_world world;
    for (int k = 0; k < 2; k++) {
        dem_pair_def *pair = dem_pair(&def, glass, k ? steel : glass);
        pair->restitution = 0.3, pair->mode = DEM_CLIPPED;
        pair->stiffness = stiffness;
    }
    dem_status status = dem_init(&world, &def, NULL);
    for (int i = 0; i < b->n && status == DEM_OK; i++) {
        const double diameter = (1.0 + 2.0 * overlap) * b->diameter[i];
        status = dem_add_spheres(&world, 1, &b->centre[3 * i], &diameter, glass, 0);
    }
    if (status == DEM_OK && dem_add_plane(&world, steel, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) < 0)
        status = DEM_BAD_ARGUMENT;
    if (status == DEM_OK &&
        dem_add_cylinder(&world, steel, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 0.5 * s->screen_diameter, 1) < 0)
        status = DEM_BAD_ARGUMENT;
    const double dt = dem_advise(&world, DEM_LINEAR, 1.0).contact / STEPS_PER_CONTACT;
    if (status == DEM_OK) status = dem_set_time_step(&world, dt);
    for (int push = 0; push < PUSHES && status == DEM_OK; push++) {
        status = dem_run(&world, PUSH_STEPS * dt, features);
        for (int i = 0; i < b->n && status == DEM_OK; i++)
            status = dem_set_motion(&world, i, dem_vec3(0, 0, 0), dem_vec3(0, 0, 0));
    }
    double speed = 0.0, before = quiet < HUGE_VAL ? -1.0 : 0.0;
    while ((speed > quiet || speed > before) && world.time < 1.0 && status == DEM_OK && !common_interrupted()) {
        status = dem_run(&world, 0.005, features);
        before = speed;
        speed = rms_speed(&world);
    }
    for (int i = 0; i < b->n && status == DEM_OK; i++) {
        const dem_vec x = dem_position(&world, i);
        b->centre[3 * i] = x.x, b->centre[3 * i + 1] = x.y, b->centre[3 * i + 2] = x.z;
    }
    dem_free(&world);
    return status;
}

/* In the bin the batch is nearly at rest: it falls as soft spheres, in large steps, settles as stiffer ones, and true
   ones are only pushed apart. Without a bin it is put on the surface as it is mixed, a third looser than at rest, and
   only pushed apart: to settle would bring the large ones up. */
static dem_status fill(batch *b, const settings *s, uint64_t *random) {
    const bool bin = s->scene == SCENE_SCREEN;
    dem_status status = stack_layers(b, 0.5 * s->screen_diameter, bin ? 0.12 : 0.4, random);
    if (status == DEM_OK) status = settle(b, s, 5e-3, bin ? 0.03 : HUGE_VAL);
    if (status == DEM_OK) status = settle(b, s, 2.5e-4, bin ? 0.03 : HUGE_VAL);
    if (status == DEM_OK) status = settle(b, s, 0.0, HUGE_VAL);
    return status;
}

/* Where passage counts: a plane below the wires; or, at the end of an outlet, an inclined wall at rest onto which
   grains fall. The outlet is not printed but for the 0.5 s that a sphere takes at least: it is inclined by 30 degrees,
   begins 20 mm below the mesh at one side, and ends 0.25 m beyond the other, where its wall crosses a level plane. */
static dem_status add_way_out(dem_world *world, const settings *s, int steel) {
    const double radius = 0.5 * s->screen_diameter, slope = RIDDLE_PI / 6.0,
                 depth = 0.02 + tan(slope) * (2.0 * radius + 0.25);
    int wall = 0;
    if (s->outlet) wall = dem_add_plane(world, steel, dem_vec3(-radius, 0, -0.02), dem_vec3(sin(slope), 0, cos(slope)));
    if (wall < 0 || dem_add_exit(world, dem_vec3(0, 0, s->outlet ? -depth : -s->exit_depth), dem_vec3(0, 0, 1)) < 0)
        return DEM_BAD_ARGUMENT;
    return DEM_OK;
}

/* The cylinder in which the batch lies; over an outlet it ends below the wires. */
static int add_side_wall(dem_world *world, const settings *s, int material) {
    const double radius = 0.5 * s->screen_diameter;
    if (!s->outlet) return dem_add_cylinder(world, material, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), radius, 1);
    dem_cone tube = dem_default_cone();
    tube.low = dem_vec3(0, 0, -0.01), tube.high = dem_vec3(0, 0, 1.0 + s->drop);
    tube.low_radius = tube.high_radius = radius;
    return dem_add_cone(world, material, &tube);
}

/* The screen, its side wall, and where passage counts; the batch at rest, `drop` above the bars. Or a plate. */
static dem_status build(dem_world *world, const batch *b, const settings *s, int *deck) {
    const int glass = GLASS_SPHERE, steel = STEEL_WALL;
    dem_def def = define(s);
    def.dt = 1e-6;
    const char *field;
    dem_status status = dem_init(world, &def, &field);
    if (status != DEM_OK) return status;
    dem_screen screen = dem_default_screen();
    screen.half_x = 0.5 * s->screen_diameter;
    screen.profile = s->profile ? DEM_ROUND : DEM_SEMICIRCLE;
    const bool plate = s->scene == SCENE_CLOSED_PLATE;
    const double top = plate ? 0.0 : 0.5 * screen.wire;
    *deck = plate ? dem_add_plane(world, steel, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1))
                  : dem_add_screen(world, steel, &screen);
    const int wall = add_side_wall(world, s, s->walls ? PVC_WALL : STEEL_WALL);
    if (*deck < 0 || wall < 0) status = DEM_BAD_ARGUMENT;
    if (status == DEM_OK) status = add_way_out(world, s, steel);
    const dem_vec amplitude = dem_vec3(s->sideways * s->amplitude, 0, s->vertical * s->amplitude),
                  phase = dem_vec3(0.5 * RIDDLE_PI, 0, 0);
    if (status == DEM_OK) status = dem_vibrate(world, *deck, amplitude, phase, s->frequency);
    if (status == DEM_OK) status = dem_vibrate(world, wall, amplitude, phase, s->frequency);
    for (int i = 0; i < b->n && status == DEM_OK; i++) {
        const double centre[3] = {b->centre[3 * i], b->centre[3 * i + 1], b->centre[3 * i + 2] + top + s->drop};
        status = dem_add_spheres(world, 1, centre, &b->diameter[i], glass, b->group[i]);
    }
    const double dt = dem_advise(world, DEM_LINEAR, 1.0).contact / s->dt_ratio;
    if (status == DEM_OK) status = dem_set_time_step(world, dt);
    return status;
}

/* ---- measurement ---- */

enum { CURVES = UNDERSIZE + 3, FREE = UNDERSIZE, OCCUPIED, H_STAR };
static const char *const curve_name[CURVES] = {"retained_small", "retained_near_mesh", "free_fraction",
                                               "occupied_fraction", "h_star_m"};

/* The numbers of a run: index, name in files, what several seeds give together in the JSON object, value at the end of
   run_scene(). A number more is a row more. */
typedef enum join {
    ALONE,
    SUM,
    LARGEST,
    WET_LARGEST,
    WET_MEAN,
    WET_EACH
} join; /* alone: not listed with the others; wet: where there is water */
#define NUMBERS_OF_A_RUN(X)                                                                                            \
    X(STEPS, "steps", SUM, world.step)                                                                                 \
    X(PARTICLE_STEPS, "particle_steps", SUM, world.particle_steps)                                                     \
    X(CONTACT_STEPS, "contact_steps", SUM, world.contact_steps)                                                        \
    X(ENERGY_ERROR, "energy_error_rel", LARGEST, ledger_error(&world, has_ledger)) /* NaN without a ledger */          \
    X(LIQUID_ERROR, "liquid_error_rel", WET_LARGEST, liquid_error)                                                     \
    X(BRIDGES, "bridges_mean", WET_MEAN, looks ? bridges / looks : 0.0)                                                \
    X(RUPTURES, "ruptures", WET_MEAN, wet ? wet->ruptures : 0)                                                         \
    X(LIQUID_PASSED, "liquid_passed_kg", WET_EACH, passed_liquid(&world, wet))                                         \
    X(TIME_STEP, "dt_s", ALONE, world.def.dt)                                                                          \
    X(TOP_SMALL, "top_layer_time_small_s", ALONE, top_time[SMALL]) /* mean over the particles */                       \
    X(TOP_NEAR_MESH, "top_layer_time_near_mesh_s", ALONE, top_time[NEAR_MESH])
#define NUMBER_INDEX(index, name, join, value) index,
#define NUMBER_NAME(index, name, join, value) name,
#define NUMBER_JOIN(index, name, join, value) join,
#define NUMBER_SET(index, name, join, value) r->number[index] = (double)(value);
enum { NUMBERS_OF_A_RUN(NUMBER_INDEX) NUMBERS };
static const char *const number_name[NUMBERS] = {NUMBERS_OF_A_RUN(NUMBER_NAME)};
static const join number_join[NUMBERS] = {NUMBERS_OF_A_RUN(NUMBER_JOIN)};

typedef struct result {
    dem_status status;
    int samples;           /* points of the curves */
    double *curve[CURVES]; /* [samples]: share of the class's mass; shares of the apertures; eq 44 [m] */
    double number[NUMBERS];
    uint64_t hash, failed_id;
    bool done;
} result;

/* Which undersize particles are in the top layer: the body of another stands in their way down to the mesh.
   Notes the time. */
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
        if (!world->alive[i] || world->group[i] >= UNDERSIZE || l->at[i].z < 0.0) continue;
        const int x = layer_cell(l, l->at[i].x), y = layer_cell(l, l->at[i].y);
        bool covered = false;
        for (int cy = y > 0 ? y - 1 : 0; cy <= y + 1 && cy < l->cells; cy++) {
            for (int cx = x > 0 ? x - 1 : 0; cx <= x + 1 && cx < l->cells; cx++) {
                for (int k = l->head[cy * l->cells + cx]; k >= 0 && !covered; k = l->next[k]) {
                    const double dx = l->at[k].x - l->at[i].x, dy = l->at[k].y - l->at[i].y,
                                 sum = dem_radius(world, i) + dem_radius(world, k);
                    covered =
                        k != (int)i && l->at[k].z < l->at[i].z && l->at[k].z > 0.0 && dx * dx + dy * dy < sum * sum;
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

/* Mass of each class, particles and their liquid, that has not reached the outlet's end at a time [kg] (eq 21). A
   particle's liquid is its film and half of its bridges to others, all of those to walls. */
static void remaining_mass(const dem_world *world, const wet_scene *wet, double time, double delay, double *mass) {
    for (int c = 0; c < CLASSES; c++) mass[c] = 0.0;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        if (!world->alive[i]) continue;
        mass[world->group[i]] += dem_mass(world, i) + (wet ? WATER * wet->films.particle[world->id[i]] : 0.0);
    }
    for (ptrdiff_t k = 0; k < world->passed_count; k++) {
        const dem_passed *p = &world->passed[k];
        if (p->time + delay <= time + 1e-9) continue;
        mass[p->group] += GLASS * RIDDLE_PI / 6.0 * p->diameter * p->diameter * p->diameter;
        mass[p->group] += wet ? WATER * wet->films.particle[p->id] : 0.0;
    }
    for (ptrdiff_t k = 0; wet && k < dem_link_count(world); k++) {
        const dem_contact_info bridge_of = dem_get_link(world, k);
        const double liquid = WATER * bridge_of.state[0];
        mass[world->group[bridge_of.i]] += bridge_of.j < 0 ? liquid : 0.5 * liquid;
        if (bridge_of.j >= 0) mass[world->group[bridge_of.j]] += 0.5 * liquid;
    }
}

/* Accumulated deviation of the classes' mean heights from the mean height (eq 44) [m]. */
static double height_deviation(const dem_world *world) {
    double sum[CLASSES] = {0.0}, all = 0.0, deviation = 0.0;
    int count[CLASSES] = {0}, n = 0;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        if (!world->alive[i]) continue;
        const double z = dem_position(world, i).z;
        sum[world->group[i]] += z, all += z;
        count[world->group[i]]++, n++;
    }
    for (int c = 0; c < CLASSES; c++)
        if (count[c]) deviation += fabs(sum[c] / count[c] - all / n);
    return deviation;
}

/* ---- one run ---- */

/* Who looks on; any of them may be NULL. */
typedef struct observer {
    progress *bar;
    dem_io_series *series;
    world_movie *reel;
    const char *out; /* folder of the series and of the picture; NULL: none */
} observer;

static picture_def screen_view = {
    {"small 5 mm", "near-mesh 7 mm", "large 10 mm"}, CLASSES, 0.0, {0.3, 1.0, -0.75}, {960, 640}};

static dem_status add_liquid(wet_scene **wet, dem_world *world, const batch *b, const settings *s, int deck) {
    *wet = malloc(sizeof **wet);
    if (!*wet) return DEM_OUT_OF_MEMORY;
    world->user = *wet;
    const bridge_status status = wet_init(*wet, b->n, b->group, b->diameter, class_diameter, s->moisture, batch_mass(b),
                                          deck, world, s->laws == 1, s->walls ? WET_PVC : WET_STEEL);
    return status == BRIDGE_OK ? DEM_OK : DEM_BAD_ARGUMENT;
}

/* `initial` [CLASSES] is filled by the first sample. */
static void sample_curves(result *r, int sample, const dem_world *world, const settings *s, const wet_scene *wet,
                          int deck, double time, double *initial) {
    double mass[CLASSES];
    remaining_mass(world, wet, time, s->outlet_delay, mass);
    if (sample == 0) memcpy(initial, mass, sizeof mass);
    for (int c = 0; c < UNDERSIZE; c++) r->curve[c][sample] = initial[c] > 0.0 ? mass[c] / initial[c] : 0.0;
    const dem_apertures holes = dem_count_apertures(world, deck);
    r->curve[FREE][sample] = holes.total ? (double)holes.free / holes.total : 1.0;
    r->curve[OCCUPIED][sample] = holes.total ? (double)holes.occupied / holes.total : 0.0;
    r->curve[H_STAR][sample] = height_deviation(world);
    r->samples = sample + 1;
}

/* The bottom layer from the next look on, unless it passed before; never in it: to the end. */
static void mean_top_times(double *top_time, const layers *bed, const dem_world *world, const batch *b, double arrival,
                           double end) {
    double sum[UNDERSIZE] = {0.0, 0.0};
    int count[UNDERSIZE] = {0, 0};
    for (int i = 0; i < b->n; i++) {
        if (b->group[i] >= UNDERSIZE) continue;
        sum[b->group[i]] += fmin(fmax(bed->last_top[i] + WATCH - arrival, 0.0), end);
        count[b->group[i]]++;
    }
    for (ptrdiff_t k = 0; k < world->passed_count; k++) {
        const dem_passed *p = &world->passed[k];
        if (p->group < UNDERSIZE && p->time < bed->last_top[p->id] + WATCH)
            sum[p->group] -= bed->last_top[p->id] + WATCH - p->time;
    }
    for (int c = 0; c < UNDERSIZE; c++) top_time[c] = count[c] ? sum[c] / count[c] : 0.0;
}

/* Of work, released potential and initial energy [-]. */
static double ledger_error(const dem_world *world, bool has_ledger) {
    const dem_energy_ledger e = dem_energy(world);
    return has_ledger ? fabs(e.error) / (fabs(e.wall_work) + e.released + fabs(e.start)) : (double)NAN;
}

/* Liquid on what has passed [kg]. */
static double passed_liquid(const dem_world *world, const wet_scene *wet) {
    double mass = 0.0;
    for (ptrdiff_t k = 0; wet && k < world->passed_count; k++) mass += WATER * wet->films.particle[world->passed[k].id];
    return mass;
}

/* One mixture, from its making to its end. The curves have room for settings.time / SAMPLE + 1 points. */
static void run_scene(const settings *s, uint64_t seed, result *r, const observer *watcher) {
    batch b;
    dem_world world;
    layers bed;
    wet_scene *wet = NULL;
    int deck = 0, looks = 0;
    double liquid_error = 0.0, bridges = 0.0;
    memset(&b, 0, sizeof b);
    memset(&world, 0, sizeof world);
    memset(&bed, 0, sizeof bed);
    r->status = mix_batch(&b, s, &seed) ? DEM_OUT_OF_MEMORY : fill(&b, s, &seed);
    if (r->status == DEM_OK && !common_interrupted()) r->status = build(&world, &b, s, &deck);
    if (r->status == DEM_OK && s->moisture > 0.0) r->status = add_liquid(&wet, &world, &b, s, deck);
    if (r->status == DEM_OK && make_layers(&bed, b.n, 0.5 * s->screen_diameter)) r->status = DEM_OUT_OF_MEMORY;

    const bool has_ledger = s->energy && (!wet || s->laws == 0);
    const int features = DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | (has_ledger ? DEM_ENERGY : 0);
    const int watches = (int)(s->time / WATCH + 0.5), every = (int)(SAMPLE / WATCH + 0.5);
    const int shown_at = (int)(fmin(0.6, s->time) / WATCH + 0.5);
    const double arrival = sqrt(2.0 * s->drop / 9.81);
    double initial[CLASSES] = {0.0};
    for (int k = 0; k <= watches && r->status == DEM_OK && !common_interrupted(); k++) {
        const double time = k * WATCH;
        if (k > 0) r->status = wet ? wet_run(&world, WATCH, features) : dem_run(&world, WATCH, features);
        if (time >= arrival && r->status == DEM_OK) watch_layers(&bed, &world, time);
        if (k % every == 0) {
            sample_curves(r, k / every, &world, s, wet, deck, time, initial);
            if (wet) {
                int count;
                const double total = wet_total(wet, &world, &count);
                liquid_error = fmax(liquid_error, fabs(total / wet->initial - 1.0));
                bridges += count;
                looks++;
            }
            if (watcher->series) dem_io_add(watcher->series, &world);
        }
        if (watcher->reel) world_movie_add(watcher->reel, &world);
        if (watcher->out && k == shown_at) draw_world(&world, &screen_view, watcher->out, "batch_screening.png");
        if (watcher->bar && k > 0) progress_add(watcher->bar, WATCH);
    }
    if (r->status == DEM_OK && !common_interrupted()) {
        double top_time[UNDERSIZE];
        mean_top_times(top_time, &bed, &world, &b, arrival, s->time);
        NUMBERS_OF_A_RUN(NUMBER_SET)
        r->hash = dem_hash(&world);
        r->done = true;
    }
    r->failed_id = world.failed_id;
    free_layers(&bed);
    if (wet) wet_free(wet);
    free(wet);
    free_batch(&b);
    dem_free(&world);
}

#endif
