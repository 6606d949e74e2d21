/* dem.h with liquid_bridge.h: what liquid bridges cost. The bed of 20 000 spheres at rest and over a vibrating floor,
   dry; with bridges that only attract; and with their viscous resistance, as dem_wet.h composes them (films, formation
   at contact, rupture, neck split). Water; contact angle 15 degrees on the spheres, 45 on the floor; moisture 1 % of
   the spheres' mass.

   Figure of merit: particle-steps per second of processor time, wet over dry. Checks: liquid is conserved exactly, the
   same hash in every repeat.

   --compare FILE runs nothing: it tells and draws runs of several codes as benchmarks/peers/wet collects them. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bed.h"
#include "common.h"
#include "dem_wet.h"

enum { DRY, CAPILLARY, WET, STATES, SCENES = 2, REPEATS_MAX = 99, CODES = 4 };
static const char *const state_names[STATES] = {"dry", "capillary", "wet"};
static const char *const scene_names[SCENES] = {"static", "vibrated"};

typedef struct run {
    double cpu_s, height, energy;         /* [s], [m], [J] */
    double bridges, volume, liquid_error; /* bridges a sphere at the end, mean volume of one [m3], lost share
                                             of the liquid */
    uint64_t hash;
} run;

/* A wet world needs the deck of a screen for its books; this one is switched off. */
static int add_no_deck(dem_world *world) {
    dem_screen screen = dem_default_screen();
    screen.half_x = 0.02;
    screen.centre = dem_vec3(0.0, 0.0, -1.0);
    const int deck = dem_add_screen(world, 1, &screen);
    return deck >= 0 && dem_enable_wall(world, deck, 0) == DEM_OK ? deck : -1;
}

static int bed_run(run *r, const bed *b, int vibrated, int state, double moisture, int steps, int threads,
                   progress *bar) {
    dem_world world;
    wet_scene scene;
    dem_def def = bed_def(b, 0.2, DEM_CLIPPED);
    const double class_diameter[WET_CLASSES] = {bed_diameter, bed_diameter, bed_diameter};
    const double mass = RIDDLE_PI / 6.0 * bed_diameter * bed_diameter * bed_diameter * bed_density * b->n;
    int *group = calloc((size_t)b->n, sizeof *group), bridges = 0;
    double left = 0.0;
    memset(r, 0, sizeof *r);
    memset(&world, 0, sizeof world);
    memset(&scene, 0, sizeof scene);
    if (!group) return common_fail("out of memory");
    def.threads = threads;
    dem_status status = bed_world(&world, b, &def, vibrated);
    if (state != DRY && status == DEM_OK) {
        const int deck = add_no_deck(&world);
        if (deck < 0 || wet_init(&scene, b->n, group, b->diameters, class_diameter, moisture, mass, deck, &world, false,
                                 WET_STEEL) != BRIDGE_OK)
            status = DEM_BAD_ARGUMENT;
        if (state == CAPILLARY) scene.liquid.viscosity = 0.0;
        world.user = &scene;
    }
    for (int done = 0, chunk = 100; done < steps && status == DEM_OK && !common_interrupted(); done += chunk) {
        const double duration = bed_dt * (steps - done < chunk ? steps - done : chunk),
                     start = machine_processor_seconds();
        status = state == DRY ? dem_run(&world, duration, DEM_LINEAR | DEM_FRICTION) : wet_run(&world, duration, 0);
        r->cpu_s += machine_processor_seconds() - start;
        progress_add(bar, (double)chunk * b->n);
    }
    if (status == DEM_OK && state != DRY) left = wet_total(&scene, &world, &bridges);
    bed_measure(&world, &r->height, &r->energy);
    r->bridges = (double)bridges / b->n;
    r->volume = bridges ? (left - bridge_films_total(&scene.films)) / bridges : 0.0;
    r->liquid_error = state != DRY ? fabs(left / scene.initial - 1.0) : 0.0;
    r->hash = dem_hash(&world);
    dem_free(&world);
    wet_free(&scene);
    free(group);
    return status == DEM_OK
               ? 0
               : common_fail("%s, %s: %s", scene_names[vibrated], state_names[state], dem_status_text(status));
}

/* Speeds [1e6 particle-steps per CPU second] of codes in the states of both scenes; NaN where there is none. */
static void draw(const program *self, const char *const *codes, double (*speed)[SCENES * STATES], int n) {
    static const char *const groups[SCENES * STATES] = {"static, dry",   "static, capillary",   "static, wet",
                                                        "vibrated, dry", "vibrated, capillary", "vibrated, wet"};
    riddle_plot *figure = riddle_plot_new("Beds of spheres with liquid bridges, one core", 1, 1);
    riddle_plot_panel_size(figure, 820.0, 380.0);
    riddle_plot_panel(figure, 0, 0, "", "million particle-steps per CPU second");
    for (int k = 0; k < n; k++) riddle_plot_bars(figure, codes[k], groups, speed[k], SCENES * STATES);
    riddle_plot_write(figure, self->out, "dem_wet.svg");
}

/* ---- runs of several codes ---- */

static int named(const csv_data *data, int row, const char *column, const char *const *names, int n) {
    const char *cell = data->cells[row * data->columns + csv_column(data, column)];
    for (int k = 0; k < n; k++)
        if (strcmp(cell, names[k]) == 0) return k;
    return -1;
}

static void compare(const program *self, const char *path) {
    static const char *const needed[] = {"code",  "spheres", "scene",         "state",
                                         "steps", "cpu_s",   "mean_height_m", "kinetic_energy_J"};
    char message[1200];
    const char *codes[CODES];
    double speed[CODES][SCENES * STATES];
    int n = 0;
    csv_data data;
    if (csv_read(path, &data, message, sizeof message) != 0) program_refuse(self, "compare", path, "a CSV of runs");
    for (size_t k = 0; k < sizeof needed / sizeof *needed; k++) {
        snprintf(message, sizeof message, "a CSV with a column %s", needed[k]);
        if (csv_column(&data, needed[k]) < 0) program_refuse(self, "compare", path, message);
    }
    json *report = json_open(self->json);
    static const result_column columns[] = {{"code", "code", "%s"},
                                            {"|spheres"},
                                            {"scene", "scene", "%s"},
                                            {"state", "bed", "%s"},
                                            {"particle_steps_per_cpu_s", "particle-steps per CPU second", "%.3g"},
                                            {"cost_over_dry", "cost over dry", "%.2f"},
                                            {"mean_height_m", "mean height [m]", "%.7f"},
                                            {"kinetic_energy_J", "kinetic energy [J]", "%.5g"}};
    result_table *t = RESULTS(columns);
    for (int k = 0; k < CODES; k++)
        for (int g = 0; g < SCENES * STATES; g++) speed[k][g] = (double)NAN;
    for (int g = 0; g < SCENES * STATES; g++) {
        for (int row = 0; row < data.rows; row++) {
            const int scene = named(&data, row, "scene", scene_names, SCENES),
                      state = named(&data, row, "state", state_names, STATES);
            const char *code = data.cells[row * data.columns + csv_column(&data, "code")];
            if (scene != g / STATES || state != g % STATES) continue;
            int k = 0;
            while (k < n && strcmp(codes[k], code) != 0) k++;
            if (k == CODES) continue;
            if (k == n) codes[n++] = code;
            const double spheres = csv_value(&data, row, "spheres");
            speed[k][g] = 1e-6 * spheres * csv_value(&data, row, "steps") / csv_value(&data, row, "cpu_s");
            results_row(t, TEXTS(code, scene_names[scene], state_names[state]), spheres, 1e6 * speed[k][g],
                        speed[k][scene * STATES] / speed[k][g], csv_value(&data, row, "mean_height_m"),
                        csv_value(&data, row, "kinetic_energy_J"));
        }
    }
    results_write(t, report, "beds", self->out, "compare.csv");
    results_free(t);
    draw(self, codes, speed, n);
    json_program(report, self);
    json_close(report);
    csv_free(&data);
}

/* ---- own runs ---- */

/* The repeats of a bed: its last run and the median of the times [s]; 0, or -1. */
static int repeat_bed(run *r, double *cpu_s, const bed *b, int g, double moisture, int steps, int repeats,
                      progress *bar) {
    const char *scene = scene_names[g / STATES], *state = state_names[g % STATES];
    double cpu[REPEATS_MAX];
    uint64_t hash = 0;
    for (int k = 0; k < repeats; k++) {
        if (bed_run(r, b, g / STATES, g % STATES, moisture, steps, 1, bar) != 0 || common_interrupted()) return -1;
        cpu[k] = r->cpu_s;
        if (k > 0 && r->hash != hash) common_fail("%s, %s: another hash in run %d", scene, state, k + 1);
        hash = r->hash;
    }
    if (r->liquid_error != 0.0) common_fail("%s, %s: liquid is lost: %g of it", scene, state, r->liquid_error);
    *cpu_s = median(cpu, repeats);
    return 0;
}

int main(int argc, char **argv) {
    int size_choice = 1, scene_choice = 0, steps = 2500, repeats = 1;
    double moisture = 0.01;
    char place[600], message[1200];
    const char *folder = output_find(place, sizeof place, "tests/reference/beds"), *comparison = NULL,
               *label = "Riddle";
    option options[] = {
        option_choice("spheres", &size_choice, "2000|20000|100000", "number of spheres"),
        option_choice("scene", &scene_choice, "both|static|vibrated", "floor that rests or vibrates"),
        option_int("steps", "N", &steps, 1, 1000000, "time steps of 4e-6 s"),
        option_int("repeats", "N", &repeats, 1, REPEATS_MAX, "runs of each; medians are told"),
        option_double("moisture", "SHARE", &moisture, 1e-4, 0.05, "mass of water over mass of spheres [-]"),
        option_string("beds", "DIR", &folder, "folder of the start files"),
        option_string("label", "TEXT", &label, "name of this build in the CSV"),
        option_string("compare", "FILE", &comparison, "run nothing, tell and draw the runs in this CSV"),
    };
    program self = program_start("dem_wet", "dem.h with liquid_bridge.h: what liquid bridges cost in a bed of spheres.",
                                 options, sizeof options / sizeof *options, argc, argv);
    const int sizes[3] = {2000, 20000, 100000};
    if (strpbrk(label, ",\"\n")) program_refuse(&self, "label", label, "text without commas and quotes");
    if (comparison) {
        compare(&self, comparison);
        return common_exit_status();
    }
    if (self.quick && !is_given(&self, "spheres")) size_choice = 0;
    if (self.quick && !is_given(&self, "steps")) steps = 500;
    bed b;
    if (bed_read(&b, folder, sizes[size_choice], message, sizeof message) != 0)
        program_refuse(&self, "beds", folder, BED_FILES);
    json *report = json_open(self.json);
    static const result_column columns[] = {{"|code", NULL, "%s"},
                                            {"spheres"},
                                            {"scene", "bed", "%s"},
                                            {"state", "state", "%s"},
                                            {"steps"},
                                            {"cpu_s"},
                                            {"mean_height_m", "mean height [m]", "%.7f"},
                                            {"kinetic_energy_J", "kinetic energy [J]", "%.5g"},
                                            {"bridges_per_sphere", "bridges a sphere", "%.3f"},
                                            {"bridge_volume_m3", "mean volume [m3]", "%.3g"},
                                            {"particle_steps_per_cpu_s|", "particle-steps per CPU second", "%.3g"},
                                            {"cost_over_dry|", "cost over dry", "%.2f"},
                                            {"liquid_error_rel|", "liquid error", "%.1g"}};
    result_table *t = RESULTS(columns);
    double speed[1][SCENES * STATES];
    progress bar;
    progress_begin(&bar, "wet beds", (double)(scene_choice ? 1 : SCENES) * STATES * repeats * steps * b.n);
    for (int g = 0; g < SCENES * STATES; g++) speed[0][g] = (double)NAN;
    for (int g = 0; g < SCENES * STATES && !common_interrupted(); g++) {
        const int scene = g / STATES;
        double cpu_s;
        run r = {0};
        if (scene_choice != 0 && scene_choice != scene + 1) continue;
        if (repeat_bed(&r, &cpu_s, &b, g, moisture, steps, repeats, &bar) != 0) break;
        speed[0][g] = 1e-6 * (double)steps * b.n / cpu_s;
        results_row(t, TEXTS(label, scene_names[scene], state_names[g % STATES]), b.n, steps, cpu_s, r.height, r.energy,
                    r.bridges, r.volume, 1e6 * speed[0][g], speed[0][scene * STATES] / speed[0][g], r.liquid_error);
    }
    progress_end(&bar);
    bed_free(&b);
    results_write(t, report, "beds", self.out, "dem_wet.csv");
    results_free(t);
    draw(&self, &label, speed, 1);
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
