/* dem.h: how large may a time step be?

   1. Impacts of two spheres at all angles (as often as in a gas: sin 2 theta) and phases of the first step, e = 0.78
      and 0.4351, friction 0.2: error of velocities and spin, and of the energy that is left; beside plain predicted
      Verlet and leapfrog.
   2. What a step does to energy in scenes whose paths are chaotic, so that only sums can be compared: an elastic bed
      (drift of the total energy, also by plain Verlet), damped beds at rest and over a vibrating floor, a rotating
      drum, a screen. There the error is that of the energy ledger over the energy that was turned over. A scene that
      ends with much more kinetic energy than in the finest step, or fails, is called unstable. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bed.h"
#include "common.h"
#include "dem.h"
#include "impact.h"

enum { LEVELS = 9, ANGLES = 18 };
static const double divisions[LEVELS] = {4, 5, 6, 8, 10, 12, 16, 20, 40}; /* steps of the shortest contact */

/* ---- 1: impacts ---- */

enum { DEM, VERLET, LEAPFROG, METHODS };
static const char *const method_names[METHODS] = {"dem.h", "predicted Verlet", "leapfrog (LAMMPS, YADE)"};

typedef struct pooled {
    double rms, bias, most; /* of the vector of velocity and R spin, over v; mean and largest error of energy left over
                               energy before */
} pooled;

/* Energy of the motion of both spheres over that before the impact. */
static double energy_left(const pair_state *s) {
    return (0.5 * (s->vx * s->vx + s->vy * s->vy) + 0.2 * bed_diameter * bed_diameter * s->spin * s->spin) /
           (0.5 * speed * speed);
}

static void pool(pooled *o, const pair_state *s, const pair_state *exact, double weight) {
    const double x = s->vx - exact->vx, y = s->vy - exact->vy, w = 0.5 * diameter * (s->spin - exact->spin);
    const double error = energy_left(s) - energy_left(exact);
    o->rms += weight * (x * x + y * y + w * w) / (speed * speed);
    o->bias += weight * error;
    o->most = fmax(o->most, fabs(error));
}

static impact impact_of(double restitution, int angle) {
    const impact of = {restitution, 0.5 * RIDDLE_PI * (angle + 0.5) / ANGLES, DEM_CLIPPED};
    return of;
}

/* All methods at one step, against exact[ANGLES]; cpu_s: of dem.h for one impact. */
static int impacts(double restitution, int division, int phases, const pair_state *exact, pooled *of_method,
                   double *cpu_s) {
    double weights = 0.0;
    memset(of_method, 0, METHODS * sizeof *of_method);
    *cpu_s = 0.0;
    for (int a = 0; a < ANGLES; a++) weights += sin(RIDDLE_PI * (a + 0.5) / ANGLES);
    for (int a = 0; a < ANGLES; a++) {
        const impact of = impact_of(restitution, a);
        const double weight = sin(2.0 * of.angle) / weights / phases, time = 3.0 * contact_time_of(&of),
                     dt = contact_time_of(&of) / division;
        const pair_law law = law_of(&of);
        dem_world world;
        dem_status status = world_of_pairs(&world, &of, division, phases);
        const double start = machine_processor_seconds();
        if (status == DEM_OK) status = dem_run(&world, time + 2.0 * dt, DEM_LINEAR | DEM_FRICTION);
        *cpu_s += (machine_processor_seconds() - start) / (ANGLES * phases);
        for (int p = 0; p < phases && status == DEM_OK; p++) {
            const dem_vec u = dem_velocity(&world, 2 * p), v = dem_velocity(&world, 2 * p + 1);
            const pair_state s = {0.0, 0.0, u.x - v.x, u.y - v.y, dem_spin(&world, 2 * p).z, 0.0};
            pool(&of_method[DEM], &s, &exact[a], weight);
            for (int m = VERLET; m < METHODS; m++) {
                pair_state other = approach(&of, dt * (1.0 + (p + 0.5) / phases));
                pair_rate rate = {0.0, 0.0, 0.0, 0.0};
                for (int n = 0; n < 3 * division + 2; n++)
                    m == VERLET ? predicted_verlet(&law, &other, &rate, dt) : leapfrog(&law, &other, &rate, dt);
                pool(&of_method[m], &other, &exact[a], weight);
            }
        }
        dem_free(&world);
        if (status != DEM_OK) return common_fail("impact: %s", dem_status_text(status));
    }
    for (int m = 0; m < METHODS; m++) of_method[m].rms = sqrt(of_method[m].rms);
    return 0;
}

/* ---- 2: scenes ---- */

enum { ELASTIC, ELASTIC_VERLET, REST, REST_DAMPED, VIBRATED, DRUM, SCREEN, SCENES };
static const char *const scene_names[SCENES] = {"elastic bed",
                                                "elastic bed, predicted Verlet",
                                                "bed at rest, e 0.78",
                                                "bed at rest, e 0.44",
                                                "bed, vibrated",
                                                "drum",
                                                "screen"};
static const double durations[SCENES] = {0.04, 0.04, 0.02, 0.02, 0.04, 0.3, 0.5}; /* [s] */

/* n spheres on a grid of 10.5 mm, in layers upwards from z, within a cylinder around the axis z, or around y if it has
   a half width. */
static dem_status pile(dem_world *world, int n, double z, double radius, double half_width, uint64_t random) {
    static const double sizes[7] = {0.005, 0.005, 0.005, 0.005, 0.007, 0.007, 0.010};
    const double pitch = 0.0105;
    const int reach = (int)(radius / pitch) + 1;
    dem_status status = DEM_OK;
    for (int layer = 0, i = 0; i < n && layer < 100 && status == DEM_OK; layer++) {
        for (int p = -reach; p <= reach; p++) {
            for (int q = -reach; q <= reach && i < n && status == DEM_OK; q++) {
                const double d = sizes[i % 7], jitter = 0.3 * (pitch - d);
                const double at[3] = {pitch * p + jitter * (2.0 * random_share(&random) - 1.0),
                                      pitch * q + jitter * (2.0 * random_share(&random) - 1.0), z + pitch * layer};
                const double across = half_width > 0.0 ? at[2] : at[1],
                             out = half_width > 0.0 ? fabs(pitch * q) + 0.5 * pitch : 0.0;
                if (sqrt(at[0] * at[0] + across * across) + 0.5 * pitch > radius || out > 1.001 * half_width) continue;
                status = dem_add_spheres(world, 1, at, &d, 0, 0);
                i++;
            }
        }
    }
    return status;
}

static dem_def mixed_def(double step) {
    dem_def def = dem_default_def();
    const int glass = dem_add_material(&def, 2534.1, 5e10, 0.2), steel = dem_add_material(&def, 7850.0, 2.08e11, 0.3);
    dem_pair(&def, glass, glass)->restitution = 0.78, dem_pair(&def, glass, glass)->friction = 0.2;
    dem_pair(&def, glass, steel)->restitution = 0.4351, dem_pair(&def, glass, steel)->friction = 0.29;
    def.dt = step;
    return def;
}

/* Quarter full, 50 mm in radius, periodic along its axis y, 5 rad/s. */
static dem_status drum_world(dem_world *world, double step) {
    dem_def def = mixed_def(step);
    const double half_width = 0.01575; /* three columns of the pile */
    def.periodic[1] = 1;
    def.low.y = -half_width, def.high.y = half_width;
    dem_status status = dem_init(world, &def, NULL);
    const int shell = status == DEM_OK ? dem_add_cylinder(world, 1, dem_vec3(0, 0, 0), dem_vec3(0, 1, 0), 0.05, 1) : -1;
    if (status == DEM_OK && shell < 0) status = (dem_status)-shell;
    if (status == DEM_OK) status = dem_rotate(world, shell, dem_vec3(0, 0, 0), dem_vec3(0, 1, 0), 5.0);
    return status == DEM_OK ? pile(world, 200, -0.035, 0.05, half_width, 1) : status;
}

/* 90 mm wide, 8 mm apertures, 1 mm at 50.6 Hz; what passes is counted 50 mm below. */
static dem_status screen_world(dem_world *world, double step) {
    dem_def def = mixed_def(step);
    dem_screen screen = dem_default_screen();
    const dem_vec vibration = dem_vec3(0, 0, 1e-3), phase = dem_vec3(0, 0, 0);
    dem_status status = dem_init(world, &def, NULL);
    screen.half_x = 0.045;
    const int deck = status == DEM_OK ? dem_add_screen(world, 1, &screen) : -1;
    const int side = status == DEM_OK ? dem_add_cylinder(world, 1, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 0.045, 1) : -1;
    if (deck < 0 || side < 0 || dem_add_exit(world, dem_vec3(0, 0, -0.05), dem_vec3(0, 0, 1)) < 0)
        return DEM_BAD_ARGUMENT;
    status = dem_vibrate(world, deck, vibration, phase, 50.6);
    if (status == DEM_OK) status = dem_vibrate(world, side, vibration, phase, 50.6);
    return status == DEM_OK ? pile(world, 400, 0.008, 0.045, 0.0, 1) : status;
}

/* A bed of one material, its floor included; e = 1: without friction, at random speeds of up to 0.1 m/s
   along each axis. */
static dem_status one_bed(dem_world *world, const bed *b, double step, double restitution, int vibrated) {
    dem_def def = bed_def(b, restitution < 1.0 ? 0.2 : 0.0, DEM_CLIPPED);
    uint64_t random = 1;
    for (int k = 0; k < 2; k++) dem_pair(&def, 0, k)->restitution = restitution;
    def.dt = step;
    dem_status status = bed_world(world, b, &def, vibrated);
    for (int i = 0; i < b->n && restitution == 1.0 && status == DEM_OK; i++) {
        const double x = random_share(&random) - 0.5, y = random_share(&random) - 0.5, z = random_share(&random) - 0.5;
        status = dem_set_motion(world, i, dem_vec3(0.2 * x, 0.2 * y, 0.2 * z), dem_vec3(0, 0, 0));
    }
    return status;
}

/* Of an elastic bed without friction: all there is [J]. */
static double total_energy(const dem_world *world) {
    dem_energy_ledger now = dem_energy(world);
    double elastic = 0.0;
    for (ptrdiff_t k = 0; k < dem_contact_count(world); k++) {
        const double overlap = fmin(dem_get_contact(world, k).gap, 0.0);
        elastic += 0.5 * bed_stiffness * overlap * overlap;
    }
    return now.kinetic + now.potential + elastic;
}

typedef struct balance {
    dem_status status;
    double error, kinetic, cpu_s; /* of energy, over what was turned over [-]; at the end [J]; processor time [s] */
} balance;

/* Against the finest step. */
static int is_stable(const balance *r, const balance *finest) {
    return r->status == DEM_OK && r->error < 1.0 && r->kinetic < 2.0 * finest->kinetic;
}

static balance run_scene(int scene, const bed *b, double division, double duration) {
    static const double restitutions[VIBRATED + 1] = {1.0, 1.0, 0.78, 0.4351, 0.78};
    const double e = scene <= VIBRATED ? restitutions[scene] : 0.78;
    const double d = bed_diameter, mass = RIDDLE_PI / 6.0 * d * d * d * bed_density;
    const double step =
        dem_contact_time(bed_stiffness, 0.5 * mass, dem_damping_ratio(e, DEM_CLIPPED), DEM_CLIPPED) / division;
    const int elastic = scene <= ELASTIC_VERLET, features = DEM_LINEAR | DEM_FRICTION | (elastic ? 0 : DEM_ENERGY);
    balance r = {DEM_OK, (double)NAN, (double)NAN, (double)NAN};
    dem_world world;
    memset(&world, 0, sizeof world);
    r.status = scene == DRUM     ? drum_world(&world, step)
               : scene == SCREEN ? screen_world(&world, step)
                                 : one_bed(&world, b, step, e, scene == VIBRATED);
    const double cpu = machine_processor_seconds();
    if (r.status == DEM_OK && scene == ELASTIC_VERLET) r.status = dem_run_law(&world, step, &unresolved_kernel);
    else if (r.status == DEM_OK) r.status = dem_run(&world, step, features);
    const double before = elastic ? total_energy(&world) : 0.0, moving = elastic ? dem_energy(&world).kinetic : 0.0;
    for (double t = 0.0; t < duration && r.status == DEM_OK && !common_interrupted(); t += 0.01) {
        const double part = fmin(0.01, duration - t);
        r.status =
            scene == ELASTIC_VERLET ? dem_run_law(&world, part, &unresolved_kernel) : dem_run(&world, part, features);
    }
    r.cpu_s = machine_processor_seconds() - cpu;
    if (r.status == DEM_OK) {
        const dem_energy_ledger l = dem_energy(&world);
        r.kinetic = l.kinetic;
        r.error = elastic ? fabs(total_energy(&world) - before) / moving
                          : fabs(l.error) / (fabs(l.wall_work) + l.released + l.start - l.start_potential);
    }
    dem_free(&world);
    return r;
}

/* ---- all steps ---- */

typedef struct measured {
    pooled of_impact[2][LEVELS][METHODS];
    balance of_scene[SCENES][LEVELS];
} measured;

static const double restitutions[2] = {0.78, 0.4351}, none = (double)NAN;

static int measure_impacts(measured *found, result_table *runs, int phases, progress *bar) {
    riddle_io_table t = riddle_io_table_begin(
        "impacts, e|t_c/dt|dem.h: rms|energy|largest|Verlet: rms|energy|largest|leapfrog: rms|energy|largest");
    for (int r = 0; r < 2; r++) {
        pair_state exact[ANGLES];
        for (int a = 0; a < ANGLES; a++) {
            const impact of = impact_of(restitutions[r], a);
            exact[a] = exact_outcome(&of);
        }
        for (int level = 0; level < LEVELS && !common_interrupted(); level++) {
            char name[40];
            double cpu_s;
            pooled *o = found->of_impact[r][level];
            if (impacts(restitutions[r], (int)divisions[level], phases, exact, o, &cpu_s) != 0) return -1;
            riddle_io_table_cell(&t, "%g", restitutions[r]);
            riddle_io_table_cell(&t, "%g", divisions[level]);
            for (int m = 0; m < METHODS; m++) {
                riddle_io_table_cell(&t, "%.1e", o[m].rms);
                riddle_io_table_cell(&t, "%+.1e", o[m].bias);
                riddle_io_table_cell(&t, "%.1e", o[m].most);
                snprintf(name, sizeof name, "impact e %g", restitutions[r]);
                results_row(runs, TEXTS("impact", name, method_names[m], NULL), restitutions[r], divisions[level],
                            m == DEM ? cpu_s : none, none, o[m].rms, o[m].bias, o[m].most, none);
            }
            progress_add(bar, 1.0);
        }
    }
    table_end(&t);
    return 0;
}

static void measure_scenes(measured *found, result_table *runs, const bed *b, double share, progress *bar) {
    /* The finest first: the others are judged by it. */
    for (int level = LEVELS - 1; level >= 0 && !common_interrupted(); level--) {
        for (int scene = 0; scene < SCENES && !common_interrupted(); scene++) {
            balance *r = &found->of_scene[scene][level];
            const char *name = scene_names[scene == ELASTIC_VERLET ? ELASTIC : scene];
            const char *method = method_names[scene == ELASTIC_VERLET ? VERLET : DEM];
            *r = run_scene(scene, b, divisions[level], share * durations[scene]);
            results_row(runs, TEXTS(name, name, method, dem_status_text(r->status)), none, divisions[level], r->cpu_s,
                        r->cpu_s, none, r->error, none, r->kinetic);
            if (level == LEVELS - 1 && r->status != DEM_OK && !common_interrupted())
                common_fail("%s, t_c/%g: %s", scene_names[scene], divisions[level], dem_status_text(r->status));
            progress_add(bar, 1.0);
        }
    }
}

static void print_scenes(const measured *found) {
    common_print("\nenergy error over the energy turned over\n");
    riddle_io_table t = riddle_io_table_begin(
        "t_c/dt|elastic bed|the same, Verlet|at rest, e 0.78|at rest, e 0.44|vibrated|drum|screen|all, processor s");
    for (int level = 0; level < LEVELS; level++) {
        double cpu_s = 0.0;
        riddle_io_table_cell(&t, "%g", divisions[level]);
        for (int scene = 0; scene < SCENES; scene++) {
            const balance *r = &found->of_scene[scene][level];
            cpu_s += r->cpu_s;
            if (is_stable(r, &found->of_scene[scene][LEVELS - 1])) riddle_io_table_cell(&t, "%.1e", r->error);
            else riddle_io_table_cell(&t, "unstable");
        }
        riddle_io_table_cell(&t, "%.2f", cpu_s);
    }
    table_end(&t);
}

static void draw(const program *self, const measured *found) {
    riddle_plot *figure = riddle_plot_new("dem.h: how large may a step be?", 1, 3);
    riddle_plot_panel_size(figure, 430.0, 380.0);
    for (int r = 0; r < 2; r++) {
        char title[60];
        snprintf(title, sizeof title, "Impacts at all angles, e = %g", restitutions[r]);
        riddle_plot_panel(figure, 0, r, "steps per contact time", "rms error of velocity and spin, over v [-]");
        riddle_plot_title(figure, title);
        riddle_plot_log_x(figure);
        riddle_plot_log_y(figure);
        for (int m = 0; m < METHODS; m++) {
            double y[LEVELS];
            for (int level = 0; level < LEVELS; level++) y[level] = found->of_impact[r][level][m].rms;
            riddle_plot_line(figure, method_names[m], divisions, y, LEVELS);
            riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
        }
    }
    riddle_plot_panel(figure, 0, 2, "processor time [s]", "energy error, relative [-]");
    riddle_plot_title(figure, "Scenes");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    riddle_plot_legend_outside(figure);
    for (int scene = 0; scene < SCENES; scene++) {
        double x[LEVELS], y[LEVELS];
        for (int level = 0; level < LEVELS; level++) {
            const balance *r = &found->of_scene[scene][level];
            x[level] = r->cpu_s;
            y[level] = is_stable(r, &found->of_scene[scene][LEVELS - 1]) ? r->error : (double)NAN;
        }
        riddle_plot_line(figure, scene_names[scene], x, y, LEVELS);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    }
    riddle_plot_write(figure, self->out, "dem_steps.svg");
}

int main(int argc, char **argv) {
    int phases = 100;
    double share = 1.0;
    char place[600], message[1200];
    const char *folder = output_find(place, sizeof place, "tests/reference/beds");
    option options[] = {
        option_int("phases", "N", &phases, 1, 10000, "phases of the first step for each angle of impact"),
        option_double("time", "SHARE", &share, 0.01, 100.0, "duration of the scenes over 0.02 .. 0.5 s [-]"),
        option_string("beds", "DIR", &folder, "folder of the start files"),
    };
    program self = program_start("dem_steps",
                                 "dem.h: how large may a time step be? Impacts at all angles, beds, a drum, a screen.",
                                 options, sizeof options / sizeof *options, argc, argv);
    bed b;
    if (self.quick && !is_given(&self, "phases")) phases = 10;
    if (self.quick && !is_given(&self, "time")) share = 0.1;
    if (bed_read(&b, folder, 2000, message, sizeof message) != 0) program_refuse(&self, "beds", folder, BED_FILES);
    static measured found;
    json *report = json_open(self.json);
    static const result_column columns[] = {{"scene|", NULL, "%s"},
                                            {"|scene", NULL, "%s"},
                                            {"?restitution|"},
                                            {"integrator", NULL, "%s"},
                                            {"steps_per_contact"},
                                            {"|cpu_s"},
                                            {"?cpu_s|"},
                                            {"?error_rms"},
                                            {"energy_error_rel"},
                                            {"?energy_error_max"},
                                            {"?kinetic_energy_J|"},
                                            {"?status|", NULL, "%s"}};
    result_table *runs = RESULTS(columns);
    progress bar;
    progress_begin(&bar, "steps", LEVELS * (2.0 + SCENES));
    if (measure_impacts(&found, runs, phases, &bar) != 0) return common_exit_status();
    measure_scenes(&found, runs, &b, share, &bar);
    progress_end(&bar);
    bed_free(&b);
    if (common_interrupted()) return common_exit_status();
    results_json(runs, report, "runs");
    results_csv(runs, self.out, "dem_steps.csv");
    results_free(runs);
    print_scenes(&found);
    draw(&self, &found);
    json_bool(report, "deterministic_build", dem_build_is_deterministic() != 0);
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
