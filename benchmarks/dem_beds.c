/* dem.h: how fast, at equal physics. Beds of 2 000, 20 000 and 100 000 spheres of 5 mm, 22 diameters deep, periodic in
   x and y, on a floor that vibrates (1 mm, 50.6 Hz: the bed is thrown after 5 ms, mostly bookkeeping of neighbours that
   don't touch) or rests (five contacts a sphere throughout: bound by contacts and their history), with friction and
   without.

   Figure of merit: particle-steps per second of processor time. Checks: mean height to 5e-6 m and kinetic energy to 0.5
   % of what LAMMPS computes from the same start (tests/reference/beds/lammps.csv); 2e-5 m and 2 % without friction,
   where the skin of LAMMPS's neighbour list alone changes the energy by 1.2 %; the same hash in every repeat and for
   any number of threads. Each bed runs on one thread, those of 20 000 and more then on --threads.

   --compare FILE runs nothing: it takes runs of several codes, as benchmarks/peers/run collects them, and draws
   medians and ratios. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bed.h"
#include "common.h"
#include "dem.h"

enum { SIZES = 3, SCENES = 4, REPEATS_MAX = 99 };

static const int sizes[SIZES] = {2000, 20000, 100000};
static const char *const size_names[SIZES] = {"2000 spheres", "20 000 spheres", "100 000 spheres"};
static const char *const scene_names[SCENES] = {"vibrated", "static", "vibrated, no friction", "static, no friction"};

enum { FULL_STEPS = 5000 };                                           /* to which the references belong */
static const double height_tolerance = 5e-6, energy_tolerance = 5e-3; /* with friction */
/* Without: other roundings already make much of this, in LAMMPS too. */
static const double height_scatter = 2e-5, energy_scatter = 2e-2;

static int is_static(int scene) { return scene & 1; }
static int has_friction(int scene) { return scene < 2; }

/* What one run tells. */
typedef struct run {
    int spheres, scene, threads, steps;
    double cpu_s, wall_s, height, energy, contacts, looks;
    long long rebuilds;
    uint64_t hash;
} run;

static int bed_run(run *r, const bed *b, double skin, progress *bar) {
    dem_world world;
    memset(&world, 0, sizeof world);
    dem_def def = bed_def(b, has_friction(r->scene) ? 0.2 : 0.0, DEM_NAIVE);
    def.threads = r->threads;
    def.skin = skin;
    dem_status status = bed_world(&world, b, &def, !is_static(r->scene));
    const int features = DEM_LINEAR | (has_friction(r->scene) ? DEM_FRICTION : 0), chunk = 500;
    r->cpu_s = r->wall_s = 0.0;
    for (int done = 0; done < r->steps && status == DEM_OK && !common_interrupted(); done += chunk) {
        const int steps = r->steps - done < chunk ? r->steps - done : chunk;
        const double cpu = machine_processor_seconds(), wall = machine_seconds();
        status = dem_run(&world, steps * bed_dt, features);
        r->cpu_s += machine_processor_seconds() - cpu;
        r->wall_s += machine_seconds() - wall;
        progress_add(bar, (double)steps * b->n);
    }
    bed_measure(&world, &r->height, &r->energy);
    r->contacts = 2.0 * (double)world.contact_steps / (double)world.particle_steps;
    r->looks = (double)world.looks / (double)world.particle_steps;
    r->rebuilds = (long long)world.rebuilds;
    r->hash = dem_hash(&world);
    if (status != DEM_OK)
        common_fail("%d spheres, %s: %s (step %lld)", r->spheres, scene_names[r->scene], dem_status_text(status),
                    (long long)world.step);
    dem_free(&world);
    return status == DEM_OK ? 0 : -1;
}

/* ---- the references ---- */

typedef struct reference {
    int known;
    double height, energy;
} reference;

static int size_of(double spheres) {
    for (int s = 0; s < SIZES; s++)
        if (spheres == sizes[s]) return s;
    return -1;
}

/* The scene that a row of a table names by its columns "scene" and "friction"; -1 if none. */
static int scene_of(const csv_data *data, int row) {
    const int column = csv_column(data, "scene");
    const double friction = csv_value(data, row, "friction");
    if (column < 0 || !(friction == 0.0 || friction == 1.0)) return -1;
    const char *name = data->cells[row * data->columns + column];
    if (strcmp(name, "vibrated") != 0 && strcmp(name, "static") != 0) return -1;
    return (friction == 1.0 ? 0 : 2) + (name[0] == 's');
}

static int references_read(reference (*references)[SCENES], const char *folder) {
    char path[1000], message[1200];
    csv_data data;
    memset(references, 0, SIZES * sizeof *references);
    riddle_io_path(path, sizeof path, folder, "lammps.csv");
    if (csv_read(path, &data, message, sizeof message) != 0) return -1;
    for (int row = 0; row < data.rows; row++) {
        const int size = size_of(csv_value(&data, row, "spheres")), scene = scene_of(&data, row);
        if (size < 0 || scene < 0) continue;
        references[size][scene].known = 1;
        references[size][scene].height = csv_value(&data, row, "mean_height_m");
        references[size][scene].energy = csv_value(&data, row, "kinetic_energy_J");
    }
    csv_free(&data);
    return 0;
}

static bool same_physics(const reference *of, int scene, double height, double energy) {
    const int friction = has_friction(scene);
    return fabs(height - of->height) <= (friction ? height_tolerance : height_scatter) &&
           fabs(energy / of->energy - 1.0) <= (friction ? energy_tolerance : energy_scatter);
}

/* ---- runs of several codes ---- */

enum { CODES = 8 };

static double spread_speed(const csv_data *data, const char *code, int size, int scene, double *height, double *energy,
                           int *steps) {
    double speeds[REPEATS_MAX];
    int n = 0, column = csv_column(data, "code");
    for (int row = 0; row < data->rows && n < REPEATS_MAX; row++) {
        if (strcmp(data->cells[row * data->columns + column], code) != 0 || scene_of(data, row) != scene) continue;
        if (size_of(csv_value(data, row, "spheres")) != size) continue;
        speeds[n++] = sizes[size] * csv_value(data, row, "steps") / csv_value(data, row, "cpu_s");
        *height = csv_value(data, row, "mean_height_m");
        *energy = csv_value(data, row, "kinetic_energy_J");
        *steps = (int)csv_value(data, row, "steps");
    }
    return n ? median(speeds, n) : (double)NAN;
}

static const char *bed_kind(int scene) { return is_static(scene) ? "static" : "vibrated"; }

/* The codes that a table names. */
static int codes_of(const csv_data *data, const char **codes) {
    int n = 0;
    for (int row = 0; row < data->rows; row++) {
        const char *code = data->cells[row * data->columns + csv_column(data, "code")];
        int k = 0;
        while (k < n && strcmp(codes[k], code) != 0) k++;
        if (k == n && n < CODES) codes[n++] = code;
    }
    return n;
}

/* What was measured of one bed: by each code, and how many of Riddle's are other physics; groups: the beds so far. */
typedef struct comparison {
    const char *codes[CODES];
    double speed[CODES][SIZES * SCENES];
    int size[SIZES * SCENES], scene[SIZES * SCENES];
    int n_codes, groups, base, wrong; /* base: the code that ratios are to */
} comparison;

static void add_bed(comparison *c, result_table *r, const csv_data *data, int size, int scene, const reference *of) {
    double height[CODES] = {0.0}, energy[CODES] = {0.0}, own[CODES];
    int steps[CODES] = {0}, any = 0;
    for (int k = 0; k < c->n_codes; k++) {
        own[k] = c->speed[k][c->groups] =
            spread_speed(data, c->codes[k], size, scene, &height[k], &energy[k], &steps[k]);
        any += own[k] > 0.0;
    }
    if (!any) return;
    for (int k = 0; k < c->n_codes; k++) {
        if (!(own[k] > 0.0)) continue;
        const bool judged = of->known && steps[k] == FULL_STEPS,
                   same = judged && same_physics(of, scene, height[k], energy[k]);
        c->wrong += judged && !same &&
                    strncmp(c->codes[k], "Riddle", 6) == 0; /* another code's is told, but no failure of this one */
        results_row(r, TEXTS(c->codes[k], bed_kind(scene), scene_names[scene]), sizes[size], has_friction(scene),
                    own[k], own[k] / own[c->base], height[k], energy[k], judged ? same : (double)NAN);
    }
    c->size[c->groups] = size, c->scene[c->groups++] = scene;
}

static void draw_comparison(const program *self, const comparison *c) {
    static const char *const size_marks[SIZES] = {"2k", "20k", "100k"};
    riddle_plot *figure = riddle_plot_new("Beds of spheres, one core", 2, 1);
    riddle_plot_panel_size(figure, 900.0, 260.0);
    for (int friction = 1; friction >= 0; friction--) {
        double shown[CODES][SIZES * SCENES];
        const char *groups[SIZES * SCENES];
        char names[SIZES * SCENES][40];
        int n = 0;
        for (int g = 0; g < c->groups; g++) {
            if (has_friction(c->scene[g]) != friction) continue;
            for (int k = 0; k < c->n_codes; k++) shown[k][n] = 1e-6 * c->speed[k][g];
            snprintf(names[n], sizeof names[0], "%s %s", size_marks[c->size[g]], bed_kind(c->scene[g]));
            groups[n] = names[n];
            n++;
        }
        if (!n) continue;
        riddle_plot_panel(figure, friction ? 0 : 1, 0, "", "1e6 particle-steps per CPU s");
        riddle_plot_title(figure, friction ? "Friction 0.2 with history" : "Without friction");
        riddle_plot_legend_outside(figure);
        for (int k = 0; k < c->n_codes; k++) riddle_plot_bars(figure, c->codes[k], groups, shown[k], n);
    }
    riddle_plot_write(figure, self->out, "compare.svg");
}

static void compare(const program *self, const char *path, reference (*references)[SCENES]) {
    static const char *const needed[] = {"code",  "spheres", "scene",         "friction",
                                         "steps", "cpu_s",   "mean_height_m", "kinetic_energy_J"};
    char message[1200], over[100];
    comparison c = {{NULL}};
    csv_data data;
    if (csv_read(path, &data, message, sizeof message) != 0) program_refuse(self, "compare", path, "a CSV of runs");
    for (size_t k = 0; k < sizeof needed / sizeof *needed; k++) {
        snprintf(message, sizeof message, "a CSV with a column %s", needed[k]);
        if (csv_column(&data, needed[k]) < 0) program_refuse(self, "compare", path, message);
    }
    c.n_codes = codes_of(&data, c.codes);
    for (int k = 0; k < c.n_codes; k++)
        if (strcmp(c.codes[k], "LAMMPS") == 0) c.base = k; /* as it comes, else the first code */
    snprintf(over, sizeof over, "over %s", c.n_codes ? c.codes[c.base] : "");
    const result_column columns[] = {{"code", "code", "%s"},
                                     {"spheres", "spheres", "%.0f"},
                                     {"scene", NULL, "%s"},
                                     {NULL, "bed", "%s"},
                                     {"friction", NULL, "yes|no"},
                                     {"particle_steps_per_cpu_s", "particle-steps per CPU second", "%.3g"},
                                     {"ratio", over, "%.2f"},
                                     {"mean_height_m|", "mean height [m]", "%.7f"},
                                     {"kinetic_energy_J|", "kinetic energy [J]", "%.5g"},
                                     {"?same_physics", "same physics", "yes|NO"}};
    json *report = json_open(self->json);
    result_table *r = RESULTS(columns);
    for (int size = 0; size < SIZES; size++)
        for (int scene = 0; scene < SCENES; scene++) add_bed(&c, r, &data, size, scene, &references[size][scene]);
    results_write(r, report, "beds", self->out, "compare.csv");
    results_free(r);
    draw_comparison(self, &c);
    json_program(report, self);
    json_close(report);
    csv_free(&data);
    if (c.wrong) common_fail("%d beds are not the same physics as the references", c.wrong);
}

/* ---- runs ---- */

typedef struct settings {
    int size_choice, scene_choice, friction_choice, steps, repeats;
    double skin;
    const char *folder, *label;
} settings;

static bool is_wanted(const settings *s, int size, int scene) {
    return (s->size_choice == 0 || s->size_choice == size + 1) &&
           (s->scene_choice == 0 || s->scene_choice == 1 + is_static(scene)) &&
           (s->friction_choice == 0 || s->friction_choice == 2 - has_friction(scene));
}

/* Every repeat of every bed, and medians with what they are judged by. */
typedef struct measured {
    result_table *runs, *beds;
    double speeds[SIZES][SCENES]; /* on one thread [1e6 particle-steps per CPU second] */
    int wrong, changed;
} measured;

/* The repeats of a bed on one thread, and from 20 000 spheres on on several; 0, or -1. */
static int measure_bed(const program *self, const settings *s, const bed *b, int size, int scene, const reference *of,
                       measured *m, progress *bar) {
    const double all = (double)s->steps * b->n;
    const int kinds = size && self->threads > 1 ? 2 : 1;
    double cpu[2][REPEATS_MAX], wall[2][REPEATS_MAX], gain[REPEATS_MAX];
    char label[200];
    uint64_t hash = 0;
    run r[2];
    for (int k = 0; k < s->repeats * kinds; k++) { /* in turns: noise is the same for both */
        const int variant = k % kinds, turn = k / kinds;
        run *q = &r[variant];
        memset(q, 0, sizeof *q);
        q->spheres = sizes[size], q->scene = scene, q->threads = variant ? self->threads : 1, q->steps = s->steps;
        if (bed_run(q, b, s->skin, bar) != 0 || common_interrupted()) return -1;
        cpu[variant][turn] = q->cpu_s, wall[variant][turn] = q->wall_s, gain[turn] = wall[0][turn] / q->wall_s;
        snprintf(label, sizeof label, "%s%s", s->label, variant ? " threads" : "");
        results_row(m->runs, TEXTS(label, bed_kind(scene)), sizes[size], has_friction(scene), s->steps, q->cpu_s,
                    q->wall_s, q->threads, q->height, q->energy, all / q->cpu_s);
        m->changed += k && q->hash != hash;
        hash = q->hash;
    }
    for (int variant = 0; variant < kinds; variant++) {
        const run *q = &r[variant];
        const double cpu_s = median(cpu[variant], s->repeats), wall_s = median(wall[variant], s->repeats),
                     none = (double)NAN;
        const bool judged = of->known && s->steps == FULL_STEPS,
                   same = judged && same_physics(of, scene, q->height, q->energy);
        if (!variant) m->speeds[size][scene] = 1e-6 * all / cpu_s;
        m->wrong += judged && !same;
        results_row(m->beds, TEXTS(bed_kind(scene), scene_names[scene]), b->n, has_friction(scene), q->threads,
                    s->steps, cpu_s, wall_s, all / cpu_s, all / wall_s, variant ? median(gain, s->repeats) : 1.0,
                    q->contacts, q->looks, (double)q->rebuilds, q->height, q->energy, judged ? of->height : none,
                    judged ? of->energy : none, judged ? same : none);
    }
    return 0;
}

static void measure_all(const program *self, const settings *s, reference (*references)[SCENES], measured *m) {
    double work = 0.0;
    progress bar;
    for (int k = 0; k < SIZES * SCENES; k++) {
        const int size = k / SCENES, variants = size && self->threads > 1 ? 2 : 1;
        m->speeds[size][k % SCENES] = (double)NAN;
        if (is_wanted(s, size, k % SCENES)) work += (double)s->steps * sizes[size] * variants * s->repeats;
    }
    progress_begin(&bar, "beds", work);
    for (int size = 0; size < SIZES && !common_interrupted(); size++) {
        char message[1200];
        bed b;
        if (s->size_choice != 0 && s->size_choice != size + 1) continue;
        if (bed_read(&b, s->folder, sizes[size], message, sizeof message) != 0)
            program_refuse(self, "beds", s->folder, BED_FILES);
        for (int scene = 0; scene < SCENES && !common_interrupted(); scene++)
            if (is_wanted(s, size, scene)) measure_bed(self, s, &b, size, scene, &references[size][scene], m, &bar);
        bed_free(&b);
    }
    progress_end(&bar);
}

static void tell_beds(const program *self, const settings *s, reference (*references)[SCENES]) {
    static const result_column columns[] = {{"scene", NULL, "%s"},
                                            {NULL, "bed", "%s"},
                                            {"spheres", "spheres", "%.0f"},
                                            {"friction", NULL, "yes|no"},
                                            {"threads", "threads", "%.0f"},
                                            {"steps"},
                                            {"cpu_s"},
                                            {"run_wall_s"},
                                            {"particle_steps_per_cpu_s", "particle-steps per CPU second", "%.3g"},
                                            {NULL, "per second", "%.3g"},
                                            {"speed_up", "over one thread", "%.2f"},
                                            {"coordination_number", "contacts a sphere", "%.3f"},
                                            {"looks_per_particle_step", "looks a step", "%.3f"},
                                            {"list_rebuilds"},
                                            {"mean_height_m", "mean height [m]", "%.7f"},
                                            {"kinetic_energy_J", "kinetic energy [J]", "%.5g"},
                                            {"?mean_height_lammps_m"},
                                            {"?kinetic_energy_lammps_J"},
                                            {"?same_physics", "same physics", "yes|NO"}};
    static const result_column of_run[] = {{"code", NULL, "%s"},
                                           {"spheres"},
                                           {"scene", NULL, "%s"},
                                           {"friction"},
                                           {"steps"},
                                           {"cpu_s"},
                                           {"wall_s"},
                                           {"threads"},
                                           {"mean_height_m"},
                                           {"kinetic_energy_J"},
                                           {"particle_steps_per_cpu_s"}};
    static const char *const groups[SCENES] = {"vibrated", "static", "vibrated, \xc2\xb5 = 0", "static, \xc2\xb5 = 0"};
    json *report = json_open(self->json);
    measured m = {RESULTS(of_run), RESULTS(columns), {{0.0}}, 0, 0};
    measure_all(self, s, references, &m);
    results_print(m.beds);
    results_json(m.beds, report, "beds");
    results_csv(m.runs, self->out, "dem_beds.csv");
    results_free(m.beds);
    results_free(m.runs);
    json_bool(report, "same_physics", m.wrong == 0);
    json_bool(report, "same_bits", m.changed == 0);
    json_bool(report, "deterministic_build", dem_build_is_deterministic() != 0);
    riddle_plot *figure = riddle_plot_new("dem.h: beds of spheres, one thread", 1, 1);
    riddle_plot_panel(figure, 0, 0, "", "million particle-steps per CPU second");
    for (int size = 0; size < SIZES; size++) {
        if (s->size_choice == 0 || s->size_choice == size + 1)
            riddle_plot_bars(figure, size_names[size], groups, m.speeds[size], SCENES);
    }
    riddle_plot_write(figure, self->out, "dem_beds.svg");
    json_program(report, self);
    json_close(report);
    if (m.wrong) common_fail("%d runs are not the same physics as the references", m.wrong);
    if (m.changed) common_fail("%d runs gave other bits than the first", m.changed);
}

int main(int argc, char **argv) {
    char place[600];
    const char *comparison_of = NULL;
    settings s = {
        0,       0, 0, FULL_STEPS, 1, dem_default_def().skin, output_find(place, sizeof place, "tests/reference/beds"),
        "Riddle"};
    option options[] = {
        option_choice("spheres", &s.size_choice, "all|2000|20000|100000", "number of spheres"),
        option_choice("scene", &s.scene_choice, "both|vibrated|static", "floor that vibrates or rests"),
        option_choice("friction", &s.friction_choice, "both|on|off", "with friction, without"),
        option_int("steps", "N", &s.steps, 1, 1000000, "time steps of 4e-6 s; the references belong to 5000"),
        option_int("repeats", "N", &s.repeats, 1, REPEATS_MAX, "runs of each; medians are told"),
        option_positive("skin", "X", &s.skin, 1.0, "margin of the neighbour list over the diameter [-]"),
        option_string("beds", "DIR", &s.folder, "folder of the start files and references"),
        option_string("label", "TEXT", &s.label, "name of this build in the CSV"),
        option_string("compare", "FILE", &comparison_of, "run nothing, tell and draw the runs in this CSV"),
    };
    program self = program_start(
        "dem_beds", "dem.h: speed of vibrated and static beds of spheres, with the physics checked against LAMMPS.",
        options, sizeof options / sizeof *options, argc, argv);
    if (strpbrk(s.label, ",\"\n")) program_refuse(&self, "label", s.label, "text without commas and quotes");
    reference references[SIZES][SCENES];
    if (references_read(references, s.folder) != 0) program_refuse(&self, "beds", s.folder, BED_FILES);
    if (self.quick && !is_given(&self, "spheres")) s.size_choice = 1;
#ifndef _OPENMP
    self.threads = 1;
#endif
    if (comparison_of) compare(&self, comparison_of, references);
    else tell_beds(&self, &s, references);
    return common_exit_status();
}
