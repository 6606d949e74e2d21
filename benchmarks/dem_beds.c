/* dem.h: how fast, at equal physics. Beds of 2 000, 20 000 and 100 000 spheres of 5 mm, 22 diameters deep, periodic in x and y, on a floor
   that vibrates (1 mm, 50.6 Hz: the bed is thrown after 5 ms, mostly bookkeeping of neighbours that don't touch) or rests (five contacts a
   sphere throughout: bound by contacts and their history), with friction and without.

   Figure of merit: particle-steps per second of processor time. Checks: mean height to 5e-6 m and kinetic energy to 0.5 % of what LAMMPS
   computes from the same start (tests/reference/beds/lammps.csv); 2e-5 m and 2 % without friction, where the skin of LAMMPS's neighbour
   list alone changes the energy by 1.2 %; the same hash in every repeat and for any number of threads. Each bed runs on one thread, those
   of 20 000 and more then on --threads.

   --compare FILE runs nothing: it takes runs of several codes, as benchmarks/peers/run collects them, and draws medians and ratios. */
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
static const double height_scatter = 2e-5, energy_scatter = 2e-2; /* without: other roundings already make much of this, in LAMMPS too */

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
    const int features = DEM_LINEAR | (has_friction(r->scene) ? DEM_FRICTION : 0), chunk = 100;
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
        common_fail("%d spheres, %s: %s (step %lld)", r->spheres, scene_names[r->scene], dem_status_text(status), (long long)world.step);
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

static double spread_speed(const csv_data *data, const char *code, int size, int scene, double *height, double *energy, int *steps) {
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

static void compare(const program *self, const char *path, reference (*references)[SCENES]) {
    static const char *const needed[] = {"code", "spheres", "scene", "friction", "steps", "cpu_s", "mean_height_m", "kinetic_energy_J"};
    char message[1200];
    const char *codes[CODES];
    double speed[CODES][SIZES * SCENES];
    int group_size[SIZES * SCENES], group_scene[SIZES * SCENES];
    int n_codes = 0, n_groups = 0, wrong = 0;
    csv_data data;
    if (csv_read(path, &data, message, sizeof message) != 0) program_refuse(self, "compare", path, "a CSV of runs");
    for (size_t k = 0; k < sizeof needed / sizeof *needed; k++) {
        snprintf(message, sizeof message, "a CSV with a column %s", needed[k]);
        if (csv_column(&data, needed[k]) < 0) program_refuse(self, "compare", path, message);
    }
    for (int row = 0; row < data.rows; row++) {
        const char *code = data.cells[row * data.columns + csv_column(&data, "code")];
        int k = 0;
        while (k < n_codes && strcmp(codes[k], code) != 0) k++;
        if (k == n_codes && n_codes < CODES) codes[n_codes++] = code;
    }
    int base = 0; /* ratios are to LAMMPS as it comes, else to the first code */
    for (int k = 0; k < n_codes; k++)
        if (strcmp(codes[k], "LAMMPS") == 0) base = k;

    json *report = json_open(self->json);
    riddle_io_file *file = csv_open(self->out, "compare.csv", "code,spheres,scene,friction,particle_steps_per_cpu_s,ratio,same_physics");
    char header[200];
    snprintf(header, sizeof header,
             "spheres|bed|code|particle-steps per CPU second|over %s|mean height [m]|kinetic energy [J]|same physics",
             n_codes ? codes[base] : "");
    riddle_io_table t = riddle_io_table_begin(header);
    json_array_begin(report, "beds");
    for (int size = 0; size < SIZES; size++) {
        for (int scene = 0; scene < SCENES; scene++) {
            double height = 0.0, energy = 0.0;
            int steps = 0, any = 0;
            for (int k = 0; k < n_codes; k++) {
                speed[k][n_groups] = spread_speed(&data, codes[k], size, scene, &height, &energy, &steps);
                any += speed[k][n_groups] > 0.0;
            }
            if (!any) continue;
            for (int k = 0; k < n_codes; k++) {
                const double own = spread_speed(&data, codes[k], size, scene, &height, &energy, &steps),
                             ratio = own / speed[base][n_groups];
                if (!(own > 0.0)) continue;
                const reference *of = &references[size][scene];
                const bool judged = of->known && steps == FULL_STEPS, same = judged && same_physics(of, scene, height, energy);
                wrong += judged && !same && strncmp(codes[k], "Riddle", 6) == 0; /* another code's is told, but no failure of this one */
                riddle_io_table_cell(&t, "%d", sizes[size]);
                riddle_io_table_cell(&t, "%s", scene_names[scene]);
                riddle_io_table_cell(&t, "%s", codes[k]);
                riddle_io_table_cell(&t, "%.3g", own);
                riddle_io_table_cell(&t, "%.2f", ratio);
                riddle_io_table_cell(&t, "%.7f", height);
                riddle_io_table_cell(&t, "%.5g", energy);
                riddle_io_table_cell(&t, "%s", !judged ? "-" : same ? "yes" : "NO");
                csv_line(file, "%s,%d,%s,%d,%.17g,%.17g,%s", codes[k], sizes[size], is_static(scene) ? "static" : "vibrated",
                         has_friction(scene), own, ratio,
                         !judged ? ""
                         : same  ? "1"
                                 : "0");
                json_object_begin(report, NULL);
                json_string(report, "code", codes[k]);
                json_integer(report, "spheres", sizes[size]);
                json_string(report, "scene", is_static(scene) ? "static" : "vibrated");
                json_bool(report, "friction", has_friction(scene));
                json_number(report, "particle_steps_per_cpu_s", own);
                json_number(report, "ratio", ratio);
                json_number(report, "mean_height_m", height);
                json_number(report, "kinetic_energy_J", energy);
                if (judged) json_bool(report, "same_physics", same);
                json_object_end(report);
            }
            group_size[n_groups] = size, group_scene[n_groups] = scene;
            n_groups++;
        }
    }
    json_array_end(report);
    table_end(&t);
    riddle_io_close(file);
    riddle_plot *figure = riddle_plot_new("Beds of spheres, one core", 2, 1);
    riddle_plot_panel_size(figure, 900.0, 260.0);
    for (int friction = 1; friction >= 0; friction--) {
        static const char *const size_marks[SIZES] = {"2k", "20k", "100k"};
        double shown[CODES][SIZES * SCENES];
        const char *groups[SIZES * SCENES];
        char names[SIZES * SCENES][40];
        int n = 0;
        for (int g = 0; g < n_groups; g++) {
            if (has_friction(group_scene[g]) != friction) continue;
            for (int k = 0; k < n_codes; k++) shown[k][n] = 1e-6 * speed[k][g];
            snprintf(names[n], sizeof names[0], "%s %s", size_marks[group_size[g]], is_static(group_scene[g]) ? "static" : "vibrated");
            groups[n] = names[n];
            n++;
        }
        if (!n) continue;
        riddle_plot_panel(figure, friction ? 0 : 1, 0, "", "1e6 particle-steps per CPU s");
        riddle_plot_title(figure, friction ? "Friction 0.2 with history" : "Without friction");
        riddle_plot_legend_outside(figure);
        for (int k = 0; k < n_codes; k++) riddle_plot_bars(figure, codes[k], groups, shown[k], n);
    }
    riddle_plot_write(figure, self->out, "compare.svg");
    json_program(report, self);
    json_close(report);
    csv_free(&data);
    if (wrong) common_fail("%d beds are not the same physics as the references", wrong);
}

/* ---- main ---- */

int main(int argc, char **argv) {
    int size_choice = 0, scene_choice = 0, friction_choice = 0, steps = FULL_STEPS, repeats = 1;
    double skin = dem_default_def().skin;
    char place[600];
    const char *folder = output_find(place, sizeof place, "tests/reference/beds"), *comparison = NULL, *label = "Riddle";
    option options[] = {
        option_choice("spheres", &size_choice, "all|2000|20000|100000", "number of spheres"),
        option_choice("scene", &scene_choice, "both|vibrated|static", "floor that vibrates or rests"),
        option_choice("friction", &friction_choice, "both|on|off", "with friction, without"),
        option_int("steps", "N", &steps, 1, 1000000, "time steps of 4e-6 s; the references belong to 5000"),
        option_int("repeats", "N", &repeats, 1, REPEATS_MAX, "runs of each; medians are told"),
        option_positive("skin", "X", &skin, 1.0, "margin of the neighbour list over the diameter [-]"),
        option_string("beds", "DIR", &folder, "folder of the start files and references"),
        option_string("label", "TEXT", &label, "name of this build in the CSV"),
        option_string("compare", "FILE", &comparison, "run nothing, tell and draw the runs in this CSV"),
    };
    program self =
        program_start("dem_beds", "dem.h: speed of vibrated and static beds of spheres, with the physics checked against LAMMPS.", options,
                      sizeof options / sizeof *options, argc, argv);
    if (strpbrk(label, ",\"\n")) program_refuse(&self, "label", label, "text without commas and quotes");
    reference references[SIZES][SCENES];
    if (references_read(references, folder) != 0) program_refuse(&self, "beds", folder, BED_FILES);
    if (comparison) {
        compare(&self, comparison, references);
        return common_exit_status();
    }
    if (self.quick && !is_given(&self, "spheres")) size_choice = 1;
#ifndef _OPENMP
    self.threads = 1;
#endif

    int wanted[SIZES][SCENES], thread_counts[2] = {1, self.threads}, variants = self.threads > 1 ? 2 : 1;
    double work = 0.0;
    for (int size = 0; size < SIZES; size++) {
        for (int scene = 0; scene < SCENES; scene++) {
            wanted[size][scene] = (size_choice == 0 || size_choice == size + 1) &&
                                  (scene_choice == 0 || scene_choice == 1 + is_static(scene)) &&
                                  (friction_choice == 0 || friction_choice == 2 - has_friction(scene));
            if (wanted[size][scene]) work += (double)steps * sizes[size] * (size ? variants : 1) * repeats;
        }
    }
    json *report = json_open(self.json);
    riddle_io_file *file =
        csv_open(self.out, "dem_beds.csv",
                 "code,spheres,scene,friction,steps,cpu_s,wall_s,threads,mean_height_m,kinetic_energy_J,particle_steps_per_cpu_s");
    riddle_io_table t = riddle_io_table_begin(
        "spheres|bed|threads|particle-steps per CPU second|per second|over one thread|contacts a sphere|looks a step|mean height [m]|"
        "kinetic energy [J]|same physics");
    progress bar;
    progress_begin(&bar, "beds", work);
    json_array_begin(report, "beds");
    double speeds[SIZES][SCENES];
    int wrong = 0, changed = 0;
    for (int size = 0; size < SIZES; size++) {
        bed b;
        int any = 0;
        for (int scene = 0; scene < SCENES; scene++) {
            any |= wanted[size][scene];
            speeds[size][scene] = (double)NAN;
        }
        if (!any || common_interrupted()) continue;
        char message[1200];
        if (bed_read(&b, folder, sizes[size], message, sizeof message) != 0) program_refuse(&self, "beds", folder, BED_FILES);
        for (int scene = 0; scene < SCENES; scene++) {
            double cpu[2][REPEATS_MAX], wall[2][REPEATS_MAX], gain[REPEATS_MAX];
            uint64_t hash = 0;
            run r[2];
            const int kinds = size ? variants : 1; /* one thread, and several */
            int failed = !wanted[size][scene];
            for (int k = 0; k < repeats * kinds && !failed && !common_interrupted(); k++) { /* in turns: noise is the same for both */
                const int variant = k % kinds, turn = k / kinds;
                run *q = &r[variant];
                memset(q, 0, sizeof *q);
                q->spheres = sizes[size], q->scene = scene, q->threads = thread_counts[variant], q->steps = steps;
                failed = bed_run(q, &b, skin, &bar) != 0;
                if (failed || common_interrupted()) continue;
                cpu[variant][turn] = q->cpu_s, wall[variant][turn] = q->wall_s, gain[turn] = wall[0][turn] / q->wall_s;
                csv_line(file, "%s%s,%d,%s,%d,%d,%.9g,%.9g,%d,%.17g,%.17g,%.9g", label, variant ? " threads" : "", sizes[size],
                         is_static(scene) ? "static" : "vibrated", has_friction(scene), steps, q->cpu_s, q->wall_s, q->threads, q->height,
                         q->energy, (double)steps * b.n / q->cpu_s);
                changed += k && q->hash != hash;
                hash = q->hash;
            }
            for (int variant = 0; variant < kinds && !failed && !common_interrupted(); variant++) {
                const run *q = &r[variant];
                const reference *of = &references[size][scene];
                const double all = (double)steps * b.n, cpu_s = median(cpu[variant], repeats), wall_s = median(wall[variant], repeats),
                             speed_up = variant ? median(gain, repeats) : 1.0;
                const bool judged = of->known && steps == FULL_STEPS, same = judged && same_physics(of, scene, q->height, q->energy);
                if (!variant) speeds[size][scene] = 1e-6 * all / cpu_s;
                wrong += judged && !same;
                riddle_io_table_cell(&t, "%d", b.n);
                riddle_io_table_cell(&t, "%s", scene_names[scene]);
                riddle_io_table_cell(&t, "%d", q->threads);
                riddle_io_table_cell(&t, "%.3g", all / cpu_s);
                riddle_io_table_cell(&t, "%.3g", all / wall_s);
                riddle_io_table_cell(&t, "%.2f", speed_up);
                riddle_io_table_cell(&t, "%.3f", q->contacts);
                riddle_io_table_cell(&t, "%.3f", q->looks);
                riddle_io_table_cell(&t, "%.7f", q->height);
                riddle_io_table_cell(&t, "%.5g", q->energy);
                riddle_io_table_cell(&t, "%s", !judged ? "-" : same ? "yes" : "NO");
                json_object_begin(report, NULL);
                json_integer(report, "spheres", b.n);
                json_string(report, "scene", is_static(scene) ? "static" : "vibrated");
                json_bool(report, "friction", has_friction(scene));
                json_integer(report, "threads", q->threads);
                json_integer(report, "steps", steps);
                json_number(report, "cpu_s", cpu_s);
                json_number(report, "run_wall_s", wall_s);
                json_number(report, "particle_steps_per_cpu_s", all / cpu_s);
                json_number(report, "speed_up", speed_up);
                json_number(report, "coordination_number", q->contacts);
                json_number(report, "looks_per_particle_step", q->looks);
                json_integer(report, "list_rebuilds", q->rebuilds);
                json_number(report, "mean_height_m", q->height);
                json_number(report, "kinetic_energy_J", q->energy);
                if (judged) {
                    json_number(report, "mean_height_lammps_m", of->height);
                    json_number(report, "kinetic_energy_lammps_J", of->energy);
                    json_bool(report, "same_physics", same);
                }
                json_object_end(report);
            }
        }
        bed_free(&b);
    }
    progress_end(&bar);
    json_array_end(report);
    json_bool(report, "same_physics", wrong == 0);
    json_bool(report, "same_bits", changed == 0);
    json_bool(report, "deterministic_build", dem_build_is_deterministic() != 0);
    table_end(&t);
    riddle_io_close(file);
    riddle_plot *figure = riddle_plot_new("dem.h: beds of spheres, one thread", 1, 1);
    riddle_plot_panel(figure, 0, 0, "", "million particle-steps per CPU second");
    const char *const groups[SCENES] = {"vibrated", "static", "vibrated, \xc2\xb5 = 0", "static, \xc2\xb5 = 0"};
    for (int size = 0; size < SIZES; size++) {
        if (size_choice == 0 || size_choice == size + 1) riddle_plot_bars(figure, size_names[size], groups, speeds[size], SCENES);
    }
    riddle_plot_write(figure, self.out, "dem_beds.svg");
    json_program(report, &self);
    json_close(report);
    if (wrong) common_fail("%d runs are not the same physics as the references", wrong);
    if (changed) common_fail("%d runs gave other bits than the first", changed);
    return common_exit_status();
}
