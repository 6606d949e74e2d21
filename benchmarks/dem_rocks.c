/* dem.h: what a rock costs, by the number of its corners.

   Grains of gravel of 5 mm with 8 to 300 corners (dem_make_gravel). For each number: how near the core of at most 32
   corners is, the time to make a shape, and that of a touching pair: its points, and all of a step. --pour N lets N of
   them fall into a box that is periodic sideways, and measures porosity, contacts and particle-steps per second of
   processor time. rocks.csv holds the table, rocks.svg times over corners. */
#include <math.h>
#include <string.h>

#include "common.h"
#include "dem.h"
#include "riddle_plot.h"
#include "measure.h"

enum { KINDS = 8 }; /* different grains of each number of corners */
static const double size = 5e-3, rounding = 0.05, density = 2600.0;

static dem_status make_world(dem_world *w, double side, double dt, double fall) {
    dem_def def = dem_default_def();
    const int rock = dem_add_material(&def, density, 1e9, 0.3);
    dem_pair_def *pair = dem_pair(&def, rock, rock);
    pair->stiffness = 4000.0, pair->restitution = 0.3, pair->friction = 0.5;
    def.dt = dt, def.threads = 1, def.gravity = dem_vec3(0, 0, -fall);
    if (side > 0.0) def.periodic[0] = def.periodic[1] = 1, def.high.x = def.high.y = side;
    return dem_init(w, &def, NULL);
}

/* Adds the grains' shapes. deviation: mean over the diameter; seconds: to make one. */
static dem_status add_shapes(dem_world *w, int corners, uint64_t seed, double *deviation, double *core,
                             double *seconds) {
    dem_status status = DEM_OK;
    const double begun = machine_processor_seconds();
    *deviation = *core = 0.0;
    for (int k = 0; k < KINDS && status == DEM_OK; k++) {
        dem_convex s;
        status = dem_make_gravel(&s, size, 0.8, 0.75, corners, seed + (uint64_t)k, rounding, NULL);
        if (status != DEM_OK) break;
        *deviation += s.deviation / size / KINDS, *core += (double)s.corners / KINDS;
        const int shape = dem_add_shape(w, &s);
        if (shape < 0) status = (dem_status)-shape;
    }
    *seconds = (machine_processor_seconds() - begun) / KINDS;
    return status;
}

static dem__placed placed(double x, dem_quaternion q) {
    const dem__axes axes = dem__axes_of(q);
    dem__placed p;
    p.x = dem_vec3(x, 0, 0), p.axis[0] = axes.x, p.axis[1] = axes.y, p.axis[2] = axes.z;
    return p;
}

/* Adds pairs that overlap by a fifth of the rounding, turned at random. */
static dem_status add_pairs(dem_world *w, int pairs, uint64_t *random) {
    dem_status status = DEM_OK;
    for (int k = 0; k < pairs && status == DEM_OK; k++) {
        const int one = k % KINDS, two = k / KINDS % KINDS;
        const dem_convex *a = dem_get_shape(w, one), *b = dem_get_shape(w, two);
        const dem_quaternion turn[2] = {dem__random_turn(random), dem__random_turn(random)};
        dem_quaternion own[2];
        double in = 0.0, out = a->reach + b->reach;
        for (int m = 0; m < 2; m++) own[m] = dem__turns(turn[m], dem__turn_of_shape(m ? b : a));
        for (int n = 0; n < 40; n++) {
            const dem__placed pa = placed(0.5 * (in + out), own[0]), pb = placed(0.0, own[1]);
            dem__gap_of_cores gap;
            dem__find_gap(a, &pa, b, &pb, HUGE_VAL, NULL, &gap);
            if (gap.separation > 0.8 * (a->radius + b->radius)) out = pa.x.x;
            else in = pa.x.x;
        }
        for (int m = 0; m < 2 && status == DEM_OK; m++) {
            const double q[4] = {turn[m].w, turn[m].x, turn[m].y, turn[m].z};
            const double x[3] = {10.0 * size * (k % 32) + (m ? 0.0 : out), 10.0 * size * (k / 32), 0.0};
            status = dem_add_convex(w, m ? two : one, 1, x, q, 0, 0);
        }
    }
    return status;
}

/* Times touching pairs: their points, all of a step [s], and counts points a pair. */
static dem_status time_pairs(int corners, int pairs, uint64_t seed, double *row) {
    enum { TIMES = 100 };
    dem_world w;
    dem__convex_point point[DEM__POINTS_MAX];
    int64_t overlaps = 0;
    memset(&w, 0, sizeof w);
    dem_status status = make_world(&w, 0.0, 1e-9, 0.0); /* nothing moves far */
    if (status == DEM_OK) status = add_shapes(&w, corners, seed, &row[1], &row[0], &row[2]);
    if (status == DEM_OK) status = add_pairs(&w, pairs, &seed);
    if (status == DEM_OK) status = dem_run(&w, 10 * w.def.dt, DEM_LINEAR | DEM_FRICTION);
    if (status == DEM_OK) {
        dem__convex_state *convex = &w.engine->convex;
        const int64_t before = w.contact_steps;
        double begun = machine_processor_seconds();
        for (int n = 0; n < TIMES; n++)
            for (ptrdiff_t k = 0; k < convex->of_particles; k++)
                dem__points_of_pair(&w, &convex->pair[k], w.step, point, &overlaps);
        row[4] = (machine_processor_seconds() - begun) / ((double)pairs * TIMES);
        begun = machine_processor_seconds();
        status = dem_run(&w, TIMES * w.def.dt, DEM_LINEAR | DEM_FRICTION);
        row[5] = (machine_processor_seconds() - begun) / ((double)pairs * TIMES);
        row[3] = (double)(w.contact_steps - before) / ((double)pairs * TIMES);
    }
    dem_free(&w);
    return status;
}

/* Pours rocks: porosity between a fifth and four fifths of the bed's height, contacts a rock, particle-steps per
   second, overlaps of cores. */
static dem_status pour(int corners, int rocks, uint64_t seed, double *row) {
    enum { ACROSS = 8 };
    const double spacing = 1.45 * size, side = ACROSS * spacing * 0.9;
    double unused[3], top = 0.0, solids = 0.0;
    dem_world w;
    memset(&w, 0, sizeof w);
    dem_status status = make_world(&w, side, 6e-6, 9.81);
    if (status == DEM_OK && dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) < 0) status = DEM_OUT_OF_MEMORY;
    if (status == DEM_OK) status = add_shapes(&w, corners, seed, &unused[0], &unused[1], &unused[2]);
    for (int k = 0; k < rocks && status == DEM_OK; k++) {
        const dem_quaternion turn = dem__random_turn(&seed);
        const int layer = k / ((ACROSS - 1) * (ACROSS - 1)), of = k % ((ACROSS - 1) * (ACROSS - 1));
        const double q[4] = {turn.w, turn.x, turn.y, turn.z}, pitch = side / (ACROSS - 1),
                     x[3] = {pitch * (of % (ACROSS - 1)), pitch * (of / (ACROSS - 1)), (0.75 + 1.4 * layer) * size};
        status = dem_add_convex(&w, k % KINDS, 1, x, q, 0, 0);
    }
    const double begun = machine_processor_seconds();
    const double fall = sqrt(2.0 * 0.5 * 1.4 * size * rocks / ((ACROSS - 1) * (ACROSS - 1)) / 9.81);
    if (status == DEM_OK) status = dem_run(&w, fall + 0.1, DEM_LINEAR | DEM_FRICTION);
    row[2] = (double)w.particle_steps / (machine_processor_seconds() - begun);
    for (int i = 0; i < rocks && status == DEM_OK; i++) top = fmax(top, dem_position(&w, i).z);
    for (int i = 0; i < rocks && status == DEM_OK; i++) {
        const double z = dem_position(&w, i).z;
        if (z > 0.2 * top && z < 0.8 * top) solids += dem_mass(&w, i) / density;
    }
    row[0] = 1.0 - solids / (0.6 * top * side * side);
    row[1] = 2.0 * (double)dem_contact_count(&w) / rocks;
    row[3] = (double)dem_core_overlap_steps(&w);
    dem_free(&w);
    return status;
}

int main(int argc, char **argv) {
    static const int number[] = {8, 12, 16, 32, 64, 120, 300};
    int pairs = 256, rocks = 0, only = 0;
    option options[] = {
        option_int("pairs", "N", &pairs, 8, 1000, "touching pairs that are timed"),
        option_int("pour", "N", &rocks, 0, 100000, "so many rocks of each number of corners are poured, too"),
        option_int("corners", "N", &only, 0, 300, "only this number of corners"),
    };
    program self = program_start("dem_rocks", "dem.h: what rocks cost, by the number of their corners.", options,
                                 sizeof options / sizeof *options, argc, argv);
    if (self.quick && !is_given(&self, "pairs")) pairs = 16;
    static const result_column columns[] = {{"corners", "corners", "%.0f"},
                                            {"core_corners", "of the core", "%.1f"},
                                            {"deviation", "deviation/diameter [%]", "%.2f", 100.0},
                                            {"make_s", "to make one [ms]", "%.1f", 1e3},
                                            {"points", "points a pair", "%.2f"},
                                            {"points_s", "its points [ns]", "%.0f", 1e9},
                                            {"step_s", "all of a step [ns]", "%.0f", 1e9},
                                            {"porosity", "porosity", "%.3f"},
                                            {"contacts", "contacts a rock", "%.1f"},
                                            {"particle_steps_per_s", "particle-steps per second", "%.3g"},
                                            {"core_overlaps", "core overlaps", "%.0f"}};
    result_table *t = RESULTS(columns);
    for (int k = 0; k < (int)(sizeof number / sizeof *number) && !common_interrupted(); k++) {
        double row[6], bed[4] = {NAN, NAN, NAN, NAN};
        const int corners = only ? only : number[k];
        dem_status status = time_pairs(corners, pairs, self.seed, row);
        if (status == DEM_OK && rocks > 0) status = pour(corners, rocks, self.seed, bed);
        if (status != DEM_OK) return common_fail("%s", dem_status_text(status));
        results_row(t, NULL, corners, row[0], row[1], row[2], row[3], row[4], row[5], bed[0], bed[1], bed[2], bed[3]);
        if (only) break;
    }
    json *report = json_open(self.json);
    results_write(t, report, "rocks", self.out, "rocks.csv");
    json_program(report, &self);
    json_close(report);
    riddle_plot *figure = riddle_plot_new("Pairs of rocks that touch", 1, 1);
    riddle_plot_panel(figure, 0, 0, "corners", "processor time of a pair and step [us]");
    riddle_plot_line(figure, "all of a step", results_column(t, "corners", 1.0), results_column(t, "step_s", 1e6),
                     results_rows(t));
    riddle_plot_line(figure, "its points", results_column(t, "corners", 1.0), results_column(t, "points_s", 1e6),
                     results_rows(t));
    riddle_plot_write(figure, self.out, "rocks.svg");
    results_free(t);
    return common_exit_status();
}
