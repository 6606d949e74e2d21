/* dem.h with dem_wet.h: error of the interval between evaluations of liquid bridges.

   Pairs of wet spheres of 5 mm, those of the batch screen, collide at all angles (as often as in a gas: sin 2 theta)
   and phases of the interval, and rebound or stay together. After 30 ms they are compared with pairs whose bridges are
   evaluated in every step: error of relative velocity and spin over the speed of the impact, and of the energy left
   over that before. Beside it: pairs without bridges. The error of the time step of contacts: see dem_steps. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "dem_wet.h"

enum { ANGLES = 9, SPEEDS = 4, LEVELS = 6 };
static const double speeds[SPEEDS] = {0.1, 0.2, 0.4, 0.8};                              /* [m/s] */
static const double intervals[LEVELS] = {25e-6, 50e-6, 100e-6, 200e-6, 400e-6, 800e-6}; /* [s] */
/* [m], [kg/m3], between pairs [m], [s] */
static const double diameter = 0.005, density = 2534.1, apart = 0.1, duration = 0.03;

static double angle_of(int a) { return 0.5 * RIDDLE_PI * (a + 0.5) / ANGLES; }

/* Relative velocity and R spin of each pair [m/s], and is it still joined? */
typedef struct outcome {
    double v[6];
    int joined;
} outcome;

/* Pairs of one speed: out[ANGLES][phases]. An interval of 0: one step. */
static int impacts(double speed, double interval, double steps_per_contact, double moisture, int phases, outcome *out) {
    const int pairs = ANGLES * phases, n = 2 * pairs;
    const double class_diameter[WET_CLASSES] = {diameter, diameter, diameter};
    const double mass = density * RIDDLE_PI / 6.0 * diameter * diameter * diameter;
    double *diameters = malloc((size_t)n * sizeof *diameters);
    int *group = calloc((size_t)n, sizeof *group);
    dem_world world;
    wet_scene scene;
    memset(&world, 0, sizeof world);
    memset(&scene, 0, sizeof scene);
    dem_def def = dem_default_def();
    const int glass = dem_add_material(&def, density, 5e10, 0.2);
    dem_pair_def *pair = dem_pair(&def, glass, glass);
    pair->restitution = 0.7808, pair->friction = 0.1966, pair->rolling = 8.95e-5;
    def.gravity = dem_vec3(0, 0, 0);
    def.dt = 1e-6;
    dem_status status = diameters && group ? dem_init(&world, &def, NULL) : DEM_OUT_OF_MEMORY;
    for (int p = 0; p < pairs && status == DEM_OK; p++) {
        const double theta = angle_of(p / phases),
                     way = speed * intervals[LEVELS - 1] * (1.0 + (p % phases + 0.5) / phases);
        const double x = apart * (p % 100), y = apart * (p / 100);
        const double centres[2][3] = {{x, y, 0.0}, {x + diameter * cos(theta) + way, y + diameter * sin(theta), 0.0}};
        diameters[2 * p] = diameters[2 * p + 1] = diameter;
        status = dem_add_spheres(&world, 2, &centres[0][0], &diameters[2 * p], glass, 0);
        if (status == DEM_OK) status = dem_set_motion(&world, 2 * p + 1, dem_vec3(-speed, 0, 0), dem_vec3(0, 0, 0));
    }
    const int deck = status == DEM_OK ? dem_add_plane(&world, glass, dem_vec3(0, 0, -1.0), dem_vec3(0, 0, 1)) : -1;
    if (status == DEM_OK)
        status = dem_set_time_step(&world, dem_advise(&world, DEM_LINEAR, 1.0).contact / steps_per_contact);
    if (deck < 0 || wet_init(&scene, n, group, diameters, class_diameter, moisture, mass * n, deck, &world, false,
                             WET_STEEL) != BRIDGE_OK)
        status = DEM_BAD_ARGUMENT;
    if (status == DEM_OK) status = dem_set_links(&world, &wet_link_kernel, fmax(interval, 1e-9), WET_NEAR);
    world.user = &scene;
    if (status == DEM_OK) status = wet_run(&world, duration, 0);
    for (int p = 0; p < pairs && status == DEM_OK; p++) {
        const dem_vec u = dem_velocity(&world, 2 * p), v = dem_velocity(&world, 2 * p + 1);
        const dem_vec spin = dem_spin(&world, 2 * p), other = dem_spin(&world, 2 * p + 1);
        const double r = 0.5 * diameter;
        const outcome o = {
            {v.x - u.x, v.y - u.y, v.z - u.z, r * (spin.x + other.x), r * (spin.y + other.y), r * (spin.z + other.z)},
            dem_find_link(&world, 2 * p, 2 * p + 1, 0) >= 0};
        out[p] = o;
    }
    dem_free(&world);
    wet_free(&scene);
    free(diameters);
    free(group);
    return status == DEM_OK ? 0 : common_fail("impacts: %s", dem_status_text(status));
}

/* Of velocity and R spin, over v; mean error of energy left over energy before; share of pairs with another fate. */
typedef struct pooled {
    double rms, bias, strayed;
} pooled;

/* Energy of the relative motion over that before the impact. */
static double energy_left(const outcome *o, double speed) {
    const double *v = o->v;
    return (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + 0.4 * (v[3] * v[3] + v[4] * v[4] + v[5] * v[5])) /
           (speed * speed);
}

static pooled pool(const outcome *o, const outcome *exact, double speed, int phases) {
    pooled r = {0.0, 0.0, 0.0};
    double weights = 0.0;
    for (int a = 0; a < ANGLES; a++) weights += sin(2.0 * angle_of(a)) * phases;
    for (int p = 0; p < ANGLES * phases; p++) {
        const double weight = sin(2.0 * angle_of(p / phases)) / weights;
        for (int k = 0; k < 6; k++)
            r.rms += weight * (o[p].v[k] - exact[p].v[k]) * (o[p].v[k] - exact[p].v[k]) / (speed * speed);
        r.bias += weight * (energy_left(&o[p], speed) - energy_left(&exact[p], speed));
        r.strayed += weight * (o[p].joined != exact[p].joined);
    }
    r.rms = sqrt(r.rms);
    return r;
}

int main(int argc, char **argv) {
    int phases = 100;
    double moisture = 0.05, steps_per_contact = 8.0;
    option options[] = {
        option_int("phases", "N", &phases, 1, 1000, "phases of the interval for each angle of impact"),
        option_double("moisture", "SHARE", &moisture, 1e-4, 0.05, "mass of water over mass of spheres [-]"),
        option_double("steps-per-contact", "N", &steps_per_contact, 5.0, 1000.0,
                      "duration of a contact over the time step [-]"),
    };
    program self = program_start(
        "dem_links", "dem.h with liquid_bridge.h: how seldom may liquid bridges be evaluated? Impacts of wet pairs.",
        options, sizeof options / sizeof *options, argc, argv);
    if (self.quick && !is_given(&self, "phases")) phases = 20;
    outcome *exact = calloc((size_t)(ANGLES * phases), sizeof *exact),
            *out = calloc((size_t)(ANGLES * phases), sizeof *out);
    if (!exact || !out) common_fail("out of memory");
    json *report = json_open(self.json);
    static const result_column columns[] = {{"speed_m_s", "v [m/s]", "%g"},
                                            {"interval_s", "interval [s], none: no bridges", "%g"},
                                            {"error_rms", "rms error", "%.2e"},
                                            {"energy_error", "energy left, mean error", "%+.1e"},
                                            {"other_fate", "another fate", "%.4f"}};
    result_table *t = RESULTS(columns);
    riddle_plot *figure = riddle_plot_new("How seldom may liquid bridges be evaluated?", 1, 1);
    riddle_plot_panel(figure, 0, 0, "interval [s]", "rms error of velocity and spin, over v [-]");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    const int runs = self.quick ? 1 : SPEEDS;
    for (int s = 0; s < runs && exact && out && !common_interrupted(); s++) {
        double y[LEVELS];
        char label[40];
        int failed = impacts(speeds[s], 0.0, steps_per_contact, moisture, phases, exact);
        for (int level = 0; level <= LEVELS && !failed; level++) { /* the last: no bridges */
            const int dry = level == LEVELS;
            failed =
                impacts(speeds[s], dry ? 0.0 : intervals[level], steps_per_contact, dry ? 0.0 : moisture, phases, out);
            const pooled r = pool(out, exact, speeds[s], phases);
            if (!dry) y[level] = r.rms;
            results_row(t, NULL, speeds[s], dry ? (double)NAN : intervals[level], r.rms, r.bias, r.strayed);
        }
        snprintf(label, sizeof label, "%g m/s", speeds[s]);
        riddle_plot_line(figure, label, intervals, y, failed ? 0 : LEVELS);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    }
    results_write(t, report, "runs", self.out, "dem_links.csv");
    results_free(t);
    riddle_plot_write(figure, self.out, "dem_links.svg");
    json_program(report, &self);
    json_close(report);
    free(exact);
    free(out);
    return common_exit_status();
}
