/* dem.h: what each feature costs, on and off, in a dense bed at rest (five contacts a sphere) and in a dilute one over
   a vibrating floor (most spheres in flight). Nanoseconds of processor time a particle-step, medians of repeats taken
   in turns; hashes must not depend on what is skipped nor on threads.

   Instructions: `scripts/bench features` runs one feature at a time under callgrind, which counts those of
   `measured_run` alone, and hands the counts back by --instructions. The same source compiled with -DONLY_KERNEL holds
   no kernel but that of a dry frictionless scene: its count says what the presence of all others costs such a scene. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bed.h"
#include "common.h"
#include "dem.h"

enum { SCENES = 2, REPEATS_MAX = 99 };
static const char *const scene_names[SCENES] = {"dense", "dilute"};

typedef struct feature {
    const char *key, *name;
    int features, skip, periodic, threaded;
    int like; /* whose hash it must have, -1: none */
} feature;

enum { NORMAL, FRICTION, ROLLING, LEDGER, HERTZ, MINDLIN, WALLS, NO_PAIRS, NO_SPACE, NO_SKIP, THREADS, FEATURES };
static const feature features[FEATURES] = {
    {"normal", "normal force only", DEM_LINEAR, DEM_SKIP_ALL, 1, 0, -1},
    {"friction", "friction", DEM_LINEAR | DEM_FRICTION, DEM_SKIP_ALL, 1, 0, -1},
    {"rolling", "friction, rolling", DEM_LINEAR | DEM_FRICTION | DEM_ROLLING, DEM_SKIP_ALL, 1, 0, -1},
    {"ledger", "friction, energy ledger", DEM_LINEAR | DEM_FRICTION | DEM_ENERGY, DEM_SKIP_ALL, 1, 0, -1},
    {"hertz", "Hertz", DEM_HERTZ, DEM_SKIP_ALL, 1, 0, -1},
    {"mindlin", "Hertz-Mindlin", DEM_HERTZ | DEM_FRICTION, DEM_SKIP_ALL, 1, 0, -1},
    {"walls", "friction, walls instead of periodic sides", DEM_LINEAR | DEM_FRICTION, DEM_SKIP_ALL, 0, 0, -1},
    {"no-pairs", "friction, no pair skipped", DEM_LINEAR | DEM_FRICTION, DEM_SKIP_SPACE, 1, 0, FRICTION},
    {"no-space", "friction, no wall skipped", DEM_LINEAR | DEM_FRICTION, DEM_SKIP_PAIRS, 1, 0, FRICTION},
    {"no-skip", "friction, nothing skipped", DEM_LINEAR | DEM_FRICTION, 0, 1, 0, FRICTION},
    {"threads", "friction, threads", DEM_LINEAR | DEM_FRICTION, DEM_SKIP_ALL, 1, 1, FRICTION},
};

/* ---- scenes ---- */

/* The settled bed four times as high, with speeds of up to 0.3 m/s along each axis. */
static void dilute(bed *b) {
    uint64_t state = 1;
    for (int k = 0; k < 3 * b->n; k++) {
        b->velocities[k] = 0.6 * (random_share(&state) - 0.5);
        if (k % 3 == 2) b->centres[k] *= 4.0;
    }
}

static dem_status scene_world(dem_world *world, const bed *b, int scene, const feature *f, int threads) {
    dem_def def = bed_def(b, 0.2, DEM_CLIPPED);
    const double radius = 0.5 * bed_diameter;
    for (int k = 0; k < 2; k++) dem_pair(&def, 0, k)->rolling = 1e-4;
    /* Hertz contacts about as long as the linear ones. */
    def.material[0].young_modulus = def.material[1].young_modulus = 1e8;
    def.skip = f->skip;
    def.threads = f->threaded ? threads : 1;
    def.periodic[0] = def.periodic[1] = f->periodic;
    dem_status status = bed_world(world, b, &def, scene == 1);
    /* a radius outside: no sphere overlaps them at first */
    for (int axis = 0; axis < 2 && !f->periodic && status == DEM_OK; axis++) {
        const dem_vec in = dem_vec3(axis == 0, axis == 1, 0.0), out = dem_vec3(-in.x, -in.y, 0.0);
        const dem_vec far = dem_vec3(in.x * (b->length_x + radius), in.y * (b->length_y + radius), 0.0);
        const dem_vec near = dem_vec3(-radius * in.x, -radius * in.y, 0.0);
        if (dem_add_plane(world, 1, near, in) < 0 || dem_add_plane(world, 1, far, out) < 0) status = DEM_BAD_ARGUMENT;
    }
    return status;
}

/* ---- measuring ---- */

#ifdef ONLY_KERNEL
DEM_KERNEL(only_kernel, dem_law_linear, DEM_LINEAR)
static dem_status run(dem_world *world, double duration, int wanted) {
    return wanted == DEM_LINEAR ? dem_run_law(world, duration, &only_kernel) : DEM_BAD_ARGUMENT;
}
#else
static dem_status run(dem_world *world, double duration, int wanted) { return dem_run(world, duration, wanted); }
#endif

/* What callgrind counts: a function of its own. */
#if defined(__GNUC__)
__attribute__((noinline))
#endif
static dem_status
measured_run(dem_world *world, double duration, int wanted) {
    return run(world, duration, wanted);
}

typedef struct outcome {
    double cpu_ns, wall_ns, contacts, looks; /* a particle-step */
    uint64_t hash;
} outcome;

/* The first tenth of the steps is not measured: it fills the lists. */
static int measure(outcome *o, const bed *b, int scene, const feature *f, int threads, int steps) {
    dem_world world;
    memset(&world, 0, sizeof world);
    dem_status status = scene_world(&world, b, scene, f, threads);
    if (status == DEM_OK) status = run(&world, (steps / 10 + 1) * bed_dt, f->features);
    const int64_t before = world.particle_steps, contacts = world.contact_steps, looks = world.looks;
    const double cpu = machine_processor_seconds(), wall = machine_seconds();
    if (status == DEM_OK) status = measured_run(&world, steps * bed_dt, f->features);
    const double work = (double)(world.particle_steps - before);
    o->cpu_ns = 1e9 * (machine_processor_seconds() - cpu) / work;
    o->wall_ns = 1e9 * (machine_seconds() - wall) / work;
    o->contacts = 2.0 * (double)(world.contact_steps - contacts) / work;
    o->looks = (double)(world.looks - looks) / work;
    o->hash = dem_hash(&world);
    dem_free(&world);
    return status == DEM_OK ? 0 : common_fail("%s, %s: %s", scene_names[scene], f->name, dem_status_text(status));
}

/* ---- instructions counted by scripts/bench: scene, feature, instructions a particle-step ---- */

static int read_counts(const char *path, double (*counts)[FEATURES]) {
    char message[1200];
    csv_data data;
    if (csv_read(path, &data, message, sizeof message) != 0) return -1;
    const int scene_column = csv_column(&data, "scene"), feature_column = csv_column(&data, "feature");
    int wrong = scene_column < 0 || feature_column < 0 || csv_column(&data, "instructions") < 0;
    for (int row = 0; row < data.rows && !wrong; row++) {
        for (int scene = 0; scene < SCENES; scene++) {
            for (int k = 0; k < FEATURES; k++) {
                if (strcmp(data.cells[row * data.columns + scene_column], scene_names[scene]) == 0 &&
                    strcmp(data.cells[row * data.columns + feature_column], features[k].key) == 0)
                    counts[scene][k] = csv_value(&data, row, "instructions");
            }
        }
    }
    csv_free(&data);
    return wrong ? -1 : 0;
}

/* The wanted features in turns; 0, or -1. */
static int measure_all(const bed *b, int scene, outcome *outcomes, const int *wanted, int threads, int steps,
                       int repeats, double (*cpu)[REPEATS_MAX], double (*wall)[REPEATS_MAX], int *changed,
                       progress *bar) {
    for (int k = 0; k < repeats * FEATURES && !common_interrupted(); k++) {
        const feature *f = &features[k % FEATURES];
        outcome *o = &outcomes[k % FEATURES];
        if (!wanted[k % FEATURES]) continue;
        if (measure(o, b, scene, f, threads, steps) != 0) return -1;
        cpu[k % FEATURES][k / FEATURES] = o->cpu_ns, wall[k % FEATURES][k / FEATURES] = o->wall_ns;
        if (f->like >= 0 && wanted[f->like] && o->hash != outcomes[f->like].hash)
            *changed = 1,
            common_fail("%s, %s: another hash than with %s", scene_names[scene], f->name, features[f->like].name);
        progress_add(bar, 1.0);
    }
    return 0;
}

/* ns, counts: [scene][feature] */
static void draw(const program *self, int scene_choice, bool counted, double (*ns)[FEATURES],
                 double (*counts)[FEATURES]) {
    const int panels = counted ? 2 : 1, shown = THREADS; /* processor time of threads that wait says nothing */
    const char *names[FEATURES];
    for (int k = 0; k < shown; k++) names[k] = features[k].key;
    riddle_plot *figure = riddle_plot_new("dem.h: what each feature costs", SCENES, panels);
    riddle_plot_panel_size(figure, 760.0, 260.0);
    for (int scene = 0; scene < SCENES; scene++) {
        for (int column = 0; column < panels && (scene_choice == 0 || scene_choice == scene + 1); column++) {
            riddle_plot_panel(figure, scene, column, "",
                              column ? "instructions a particle-step" : "ns a particle-step");
            riddle_plot_title(figure, scene ? "Dilute, vibrated" : "Dense bed at rest");
            riddle_plot_bars(figure, NULL, names, column ? counts[scene] : ns[scene], shown);
        }
    }
    riddle_plot_write(figure, self->out, "dem_features.svg");
}

int main(int argc, char **argv) {
    int size_choice = 1, scene_choice = 0, feature_choice = 0, steps = 500, repeats = 3;
    char place[600], message[1200];
    const char *folder = output_find(place, sizeof place, "tests/reference/beds"), *counted = NULL;
    option options[] = {
        option_choice("spheres", &size_choice, "2000|20000|100000", "number of spheres"),
        option_choice("scene", &scene_choice, "both|dense|dilute",
                      "bed at rest, or spheres in flight over a vibrating floor"),
        option_choice("feature", &feature_choice,
                      "all|normal|friction|rolling|ledger|hertz|mindlin|walls|no-pairs|no-space|no-skip|threads",
                      "one feature only"),
        option_int("steps", "N", &steps, 1, 1000000, "measured time steps of 4e-6 s"),
        option_int("repeats", "N", &repeats, 1, REPEATS_MAX, "runs of each; medians are told"),
        option_string("beds", "DIR", &folder, "folder of the start files"),
        option_string("instructions", "FILE", &counted,
                      "CSV of instructions a particle-step, told and drawn with the rest"),
    };
    program self =
        program_start("dem_features", "dem.h: what each feature costs, on and off, in a dense and in a dilute scene.",
                      options, sizeof options / sizeof *options, argc, argv);
    const int sizes[3] = {2000, 20000, 100000};
    double counts[SCENES][FEATURES], ns[SCENES][FEATURES];
    outcome outcomes[SCENES][FEATURES];
    for (int scene = 0; scene < SCENES; scene++)
        for (int k = 0; k < FEATURES; k++) counts[scene][k] = ns[scene][k] = (double)NAN;
    if (counted && read_counts(counted, counts) != 0)
        program_refuse(&self, "instructions", counted, "a CSV with the columns scene, feature, instructions");
    if (self.quick && !is_given(&self, "spheres")) size_choice = 0;
    if (self.quick && !is_given(&self, "steps")) steps = 100;
#ifndef _OPENMP
    self.threads = 1;
#endif
    int wanted[SCENES][FEATURES]; /* the dense bed would fall apart without its periodic neighbours */
    for (int scene = 0; scene < SCENES; scene++)
        for (int k = 0; k < FEATURES; k++)
            wanted[scene][k] = (scene_choice == 0 || scene_choice == scene + 1) && (scene == 1 || k != WALLS) &&
                               (feature_choice == 0 ? k != THREADS || self.threads > 1 : feature_choice == k + 1);

    json *report = json_open(self.json);
    static const result_column columns[] = {{"spheres"},
                                            {"scene", "scene", "%s"},
                                            {"feature", NULL, "%s"},
                                            {NULL, "feature", "%s"},
                                            {"threads"},
                                            {"|cpu_ns_per_particle_step", "ns a particle-step", "%.1f"},
                                            {NULL, "over friction", "%.2f"},
                                            {"|wall_ns_per_particle_step", "wall ns", "%.1f"},
                                            {"cpu_s_per_particle_step|"},
                                            {"wall_s_per_particle_step|"},
                                            {"instructions_per_particle_step", "instructions", "%.1f"},
                                            {"contacts_per_sphere", "contacts a sphere", "%.3f"},
                                            {"looks_per_particle_step", "looks a step", "%.3f"}};
    result_table *t = RESULTS(columns);
    progress bar;
    progress_begin(&bar, "features", (double)SCENES * repeats * FEATURES);
    int changed = 0;
    for (int scene = 0; scene < SCENES; scene++) {
        bed b;
        double cpu[FEATURES][REPEATS_MAX], wall[FEATURES][REPEATS_MAX];
        if (scene_choice != 0 && scene_choice != scene + 1) continue;
        if (bed_read(&b, folder, sizes[size_choice], message, sizeof message) != 0)
            program_refuse(&self, "beds", folder, BED_FILES);
        if (scene == 1) dilute(&b);
        const int failed = measure_all(&b, scene, outcomes[scene], wanted[scene], self.threads, steps, repeats, cpu,
                                       wall, &changed, &bar);
        bed_free(&b);
        if (failed || common_interrupted()) break;
        for (int k = 0; k < FEATURES; k++)
            if (wanted[scene][k]) ns[scene][k] = median(cpu[k], repeats);
        for (int k = 0; k < FEATURES; k++) {
            if (!wanted[scene][k]) continue;
            const outcome *o = &outcomes[scene][k];
            const double wall_ns = median(wall[k], repeats);
            results_row(t, TEXTS(scene_names[scene], features[k].key, features[k].name), sizes[size_choice],
                        features[k].threaded ? self.threads : 1, ns[scene][k], ns[scene][k] / ns[scene][FRICTION],
                        wall_ns, 1e-9 * ns[scene][k], 1e-9 * wall_ns, counts[scene][k], o->contacts, o->looks);
        }
    }
    progress_end(&bar);
    results_write(t, report, "features", self.out, "dem_features.csv");
    results_free(t);
    json_bool(report, "same_bits", !changed);
    draw(&self, scene_choice, counted != NULL, ns, counts);
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
