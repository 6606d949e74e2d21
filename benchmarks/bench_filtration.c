/* filtration.h: error against run time, and the rate of the kernel.

   1. Drag of a simple cubic array of spheres (solid volume fraction 0.125, K = 4.2916, Zick and Homsy 1982): largest
      error of four places of the centre within a voxel against processor time, over voxel, lattice, precision, boundary
      and relaxation time. One row has an interpolation that needs no second fluid node.
   2. Node updates a second: bare, with faces, with beds of spheres at rest and moving, against the limit of memory:
      every population of the same memory read, changed and written back, in the same run. --part speedups: rates on
      --threads over those on one.
   3. A sphere that moves through liquid at rest: fluctuations of its drag and of the pressure beside it as it crosses
      the lattice, over the bulk viscosity; change of the liquid's mass; largest speed of a stable run. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "filtration.h"

typedef struct variant {
    const char *name, *key;
    filtration_lattice lattice;
    filtration_precision precision;
    filtration_boundary boundary;
    double tau;
} variant;

enum { VARIANTS = 7, SINGLE_NODE = 6, SIZES = 3 };
static const variant variants[VARIANTS] = {
    {"D3Q19 double, central linear, tau 1", "q19_double_linear_tau1", FILTRATION_D3Q19, FILTRATION_DOUBLE,
     FILTRATION_CENTRAL_LINEAR, 1.0},
    {"D3Q19 double, central linear, tau 3.5", "q19_double_linear_tau3.5", FILTRATION_D3Q19, FILTRATION_DOUBLE,
     FILTRATION_CENTRAL_LINEAR, 3.5},
    {"D3Q19 float, central linear, tau 3.5", "q19_float_linear_tau3.5", FILTRATION_D3Q19, FILTRATION_FLOAT,
     FILTRATION_CENTRAL_LINEAR, 3.5},
    {"D3Q15 double, central linear, tau 3.5", "q15_double_linear_tau3.5", FILTRATION_D3Q15, FILTRATION_DOUBLE,
     FILTRATION_CENTRAL_LINEAR, 3.5},
    {"D3Q19 double, half-way, tau 1", "q19_double_half_tau1", FILTRATION_D3Q19, FILTRATION_DOUBLE, FILTRATION_HALF_WAY,
     1.0},
    {"D3Q19 double, half-way, tau 3.5", "q19_double_half_tau3.5", FILTRATION_D3Q19, FILTRATION_DOUBLE,
     FILTRATION_HALF_WAY, 3.5},
    {"D3Q19 double, single node, tau 1", "q19_double_single_node_tau1", FILTRATION_D3Q19, FILTRATION_DOUBLE,
     FILTRATION_CENTRAL_LINEAR, 1.0},
};
static const int sizes[SIZES] = {12, 16, 24};
static const double places[4][3] = {{0, 0, 0}, {0.25, 0.25, 0.25}, {0.5, 0.5, 0.5}, {0.1, 0.3, 0.45}};

/* A sphere of a periodic row as a solid at rest. */
typedef struct round_solid {
    double centre[3], radius, side;
} round_solid;

static double round_distance(const void *self, const double point[3]) {
    const round_solid *s = self;
    double square = 0.0;
    for (int a = 0; a < 3; a++) {
        double d = point[a] - s->centre[a];
        d -= s->side * floor(d / s->side + 0.5);
        square += d * d;
    }
    return sqrt(square) - s->radius;
}

/* Interpolation at one node (Zhao and Yong 2017): the mean of what came to the node the step before and of what it now
   sends away from the surface, weighed by the fraction q. Needs no second fluid node, and a number for each link:
   arrived [links], kept from step to step. */
static void bounce_at_single_nodes(filtration__lattice *l, double *arrived) {
    for (ptrdiff_t n = 0; n < l->link_count; n++) {
        const filtration__link *k = &l->links[n];
        const int opposite = filtration__opposite(k->i);
        const double away = filtration__get(l, filtration__outgoing(l, k->x, k->y, k->z, opposite)),
                     q = (double)k->fraction;
        filtration__put(l, filtration__incoming(l, k->x, k->y, k->z, opposite),
                        (arrived[n] + 2.0 * q * away) / (1.0 + 2.0 * q));
    }
    for (ptrdiff_t n = 0; n < l->link_count; n++)
        arrived[n] =
            filtration__get(l, filtration__incoming(l, l->links[n].x, l->links[n].y, l->links[n].z, l->links[n].i));
}

/* The same flow as that of filtration_fluid_permeability: superficial velocity [m/s]. */
static filtration_status single_node_velocity(filtration_fluid *fluid, double gradient, double *velocity) {
    const double force[3] = {0.0, 0.0, gradient};
    double mean[3] = {0.0, 0.0, 0.0}, before = 0.0;
    double *arrived = calloc((size_t)fluid->lattice->link_count + 1, sizeof *arrived);
    filtration_status status = arrived ? filtration_fluid_set_body_force(fluid, force) : FILTRATION_NO_MEMORY;
    const int64_t interval = filtration__interval(fluid);
    for (int64_t k = 1; status == FILTRATION_OK && k < 1000000; k++) {
        status = filtration_fluid_step(fluid, NULL);
        bounce_at_single_nodes(fluid->lattice, arrived);
        if (k % interval) continue;
        filtration_fluid_mean_velocity(fluid, mean);
        if (fabs(mean[2] - before) <= 1e-5 * fabs(mean[2])) break;
        before = mean[2];
    }
    *velocity = mean[2];
    free(arrived);
    return status;
}

static int array_drag(const variant *v, int n, const double place[3], double *drag, double *seconds) {
    const double c = 0.125, side = n * 1e-6, radius = cbrt(3.0 * c / (4.0 * 3.14159265358979323846)) * side;
    filtration_fluid_def def = filtration_fluid_default_def();
    filtration_fluid fluid;
    filtration_permeability_result result;
    double centre[3], zero[3] = {0, 0, 0}, r = radius, force[3], torque[3];
    def.nodes[0] = def.nodes[1] = def.nodes[2] = n;
    def.voxel = 1e-6;
    def.lattice = v->lattice, def.precision = v->precision, def.boundary = v->boundary, def.tau = v->tau;
    for (int a = 0; a < 3; a++) centre[a] = 0.5 * side + place[a] * def.voxel;
    const filtration_spheres spheres = {1, centre, zero, zero, &r, force, torque};
    const round_solid solid = {{centre[0], centre[1], centre[2]}, radius, side};
    const int single = v == &variants[SINGLE_NODE];
    if (single) def.solid.distance = round_distance, def.solid.self = &solid;
    const double began = machine_processor_seconds();
    filtration_status status = filtration_fluid_init(&fluid, &def);
    if (status == FILTRATION_OK)
        status = single ? single_node_velocity(&fluid, 100.0, &result.velocity)
                        : filtration_fluid_permeability(&fluid, &spheres, 2, 100.0 * side, 1e-5, 1000000, &result);
    filtration_fluid_free(&fluid);
    if (status != FILTRATION_OK) return common_fail("%s", filtration_status_text(status));
    *seconds = machine_processor_seconds() - began;
    *drag = 100.0 * side * side * side / (6.0 * 3.14159265358979323846 * def.viscosity * radius * result.velocity);
    return 0;
}

static void drag_errors(const program *self, json *report) {
    double error[VARIANTS][SIZES], time[VARIANTS][SIZES];
    const int count = self->quick ? 2 : SIZES, last = self->quick ? 1 : 4;
    static const result_column columns[] = {{"method", NULL, "%s"},
                                            {NULL, "method", "%s"},
                                            {"cells_per_diameter", "cells a diameter", "%.1f"},
                                            {"largest_error", "largest error [%]", "%.3f", 100.0},
                                            {"processor_s|seconds", "time [s]", "%.3f"}};
    result_table *t = RESULTS(columns);
    for (int s = 0; s < count; s++)
        for (int v = 0; v < VARIANTS && !common_interrupted(); v++) {
            const double cells = 2.0 * cbrt(3.0 * 0.125 / (4.0 * 3.14159265358979323846)) * sizes[s];
            double worst = 0.0, least = HUGE_VAL;
            for (int p = 0; p < last; p++) {
                double drag = 0.0, seconds = 0.0;
                if (array_drag(&variants[v], sizes[s], places[p], &drag, &seconds)) return;
                worst = fmax(worst, fabs(drag / 4.2916 - 1.0));
                least = fmin(least, seconds); /* the least disturbed one */
            }
            error[v][s] = worst;
            time[v][s] = least;
            results_row(t, TEXTS(variants[v].key, variants[v].name), cells, worst, least);
        }
    results_write(t, report, "drag", self->out, "drag.csv");
    results_free(t);
    if (common_interrupted()) return;
    riddle_plot *figure =
        riddle_plot_new("Simple cubic array, solid fraction 0.125: error of the drag against run time", 1, 1);
    riddle_plot_panel_size(figure, 560, 380);
    riddle_plot_panel(figure, 0, 0, "processor time to the steady flow [s]",
                      "largest error of the drag, four places of the centre [-]");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    for (int v = 0; v < VARIANTS; v++) {
        riddle_plot_line(figure, variants[v].name, time[v], error[v], count);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED | (v > 3 ? RIDDLE_PLOT_DASHED : 0), v);
    }
    riddle_plot_legend_outside(figure);
    riddle_plot_write(figure, self->out, "drag.svg");
}

/* Changes each of `size` numbers, a cache line at a time: loops of constant length are compiled to vectors. */
static void touch_doubles(double *f, size_t size) {
    for (size_t k = 0; k < size; k += 8)
        for (size_t j = k; j < k + 8; j++) f[j] = f[j] * 0.5 + 1e-3;
}
static void touch_floats(float *f, size_t size) {
    for (size_t k = 0; k < size; k += 16)
        for (size_t j = k; j < k + 16; j++) f[j] = f[j] * 0.5f + 1e-3f;
}

/* Millions of nodes a second that a pass over as many populations in place allows. n: a multiple of 16. */
static double memory_limit(int n, int single) {
    const size_t size = (size_t)n * (size_t)n * (size_t)n * 19;
    double best = HUGE_VAL;
    void *block = calloc(size, single ? sizeof(float) : sizeof(double));
    if (!block) return (double)NAN;
    for (int pass = 0; pass < 6; pass++) {
        const double began = machine_processor_seconds();
        if (single) touch_floats((float *)block, size);
        else touch_doubles((double *)block, size);
        const double spent = machine_processor_seconds() - began;
        if (pass > 0 && spent < best) best = spent; /* the first one finds the pages */
    }
    const double check = single ? (double)((float *)block)[size / 2] : ((double *)block)[size / 2];
    free(block);
    return check > 0.0 ? (double)(size / 19) / best * 1e-6 : (double)NAN;
}

/* What the rates are measured with. */
typedef enum rate_case { BARE, BULK, ONE_SPHERE, FACES, WALLS, BED, MOVING_BED, RATE_CASES } rate_case;
static const char *const rate_names[] = {"bare fluid, periodic",
                                         "with a bulk viscosity",
                                         "one moving sphere of 20 cells",
                                         "two pressure faces",
                                         "six walls",
                                         "bed at rest: spheres of 15 cells, porosity 0.57",
                                         "the same spheres, moving"};
static const char *const rate_keys[] = {"bare", "bulk", "sphere", "faces", "walls", "bed", "moving_bed"};

/* A cubic bed, 16 nodes from centre to centre. */
static double bed_distance(const void *self, const double point[3]) {
    const double voxel = *(const double *)self;
    double square = 0.0;
    for (int a = 0; a < 3; a++) {
        const double d = point[a] / voxel - 8.3;
        square += pow(d - 16.0 * floor(d / 16.0 + 0.5), 2);
    }
    return voxel * (sqrt(square) - 7.5);
}

enum { MOST_SPHERES = 512 };
typedef struct moving_spheres {
    double centre[3 * MOST_SPHERES], velocity[3 * MOST_SPHERES], spin[3 * MOST_SPHERES], radius[MOST_SPHERES],
        force[3 * MOST_SPHERES], torque[3 * MOST_SPHERES];
} moving_spheres;

static int place_spheres(moving_spheres *s, rate_case what, int n, double voxel, double dt) {
    const int side = what == MOVING_BED ? n / 16 : 1;
    int count = 0;
    memset(s, 0, sizeof *s);
    if (what != ONE_SPHERE && what != MOVING_BED) return 0;
    for (int z = 0; z < side; z++)
        for (int y = 0; y < side; y++)
            for (int x = 0; x < side; x++, count++) {
                const int at[3] = {x, y, z};
                s->radius[count] = (what == MOVING_BED ? 7.5 : 10.0) * voxel;
                for (int a = 0; a < 3; a++) {
                    s->centre[3 * count + a] =
                        (what == MOVING_BED ? 16.0 * at[a] + 8.0 + 0.05 * ((count + a) % 5) : 0.5 * n + 0.13 * a) *
                        voxel;
                    s->velocity[3 * count + a] =
                        0.003 * ((count + a) % 3 - (what == MOVING_BED ? 1.0 : -1.0)) * voxel / dt;
                }
            }
    return count;
}

/* Millions of node updates a second of a clock: processor time, or for several threads that on the wall. */
static double rate(int n, int single, rate_case what, int threads, double (*clock)(void)) {
    static moving_spheres s;
    filtration_fluid_def def = filtration_fluid_default_def();
    filtration_fluid fluid;
    double best = HUGE_VAL;
    def.nodes[0] = def.nodes[1] = def.nodes[2] = n;
    def.precision = single ? FILTRATION_FLOAT : FILTRATION_DOUBLE;
    def.skip = 0, def.threads = threads;
    if (what == BULK) def.bulk_ratio = 20.0;
    if (what == FACES) def.face[FILTRATION_LOW_Z] = def.face[FILTRATION_HIGH_Z] = FILTRATION_PRESSURE;
    for (int f = 0; f < 6 && what == WALLS; f++) def.face[f] = FILTRATION_WALL;
    if (what == BED) def.solid.distance = bed_distance, def.solid.self = &def.voxel;
    if (filtration_fluid_init(&fluid, &def) != FILTRATION_OK) return (double)NAN;
    const int count = place_spheres(&s, what, n, def.voxel, fluid.dt);
    const filtration_spheres spheres = {count, s.centre, s.velocity, s.spin, s.radius, s.force, s.torque};
    for (int round = 0; round < 5; round++) {
        const double began = clock();
        for (int k = 0; k < 4; k++) {
            if (filtration_fluid_step(&fluid, &spheres) != FILTRATION_OK) best = (double)NAN;
            for (int i = 0; i < 3 * count; i++) s.centre[i] += s.velocity[i] * fluid.dt;
        }
        const double spent = clock() - began;
        if (round > 0 && spent < best) best = spent;
    }
    filtration_fluid_free(&fluid);
    return 4e-6 * n * n * n / best;
}

static void rates(const program *self, json *report) {
    const int n = self->quick ? 64 : 128;
    static const result_column columns[] = {{"precision", "precision", "%s"},
                                            {"case", NULL, "%s"},
                                            {NULL, "what", "%s"},
                                            {"mlups", "MLUPS", "%.1f"},
                                            {"over_bare", "over bare", "%.2f"},
                                            {"over_limit", "over the limit of memory", "%.2f"}};
    result_table *t = RESULTS(columns);
    for (int single = 0; single < 2 && !common_interrupted(); single++) {
        const double limit = memory_limit(n, single);
        double bare = 0.0;
        for (int what = 0; what < RATE_CASES && !common_interrupted(); what++) {
            const double mlups = rate(n, single, (rate_case)what, 1, machine_processor_seconds);
            if (what == BARE) bare = mlups;
            results_row(t, TEXTS(single ? "float" : "double", rate_keys[what], rate_names[what]), mlups, mlups / bare,
                        mlups / limit);
        }
    }
    results_write(t, report, "rates", self->out, "rates.csv");
    results_free(t);
}

/* Doubles on several threads and on one, by the clock on the wall. Only a machine without other work tells. */
static void speedups(const program *self, json *report) {
    const int n = self->quick ? 64 : 128;
    static const result_column columns[] = {{"case", NULL, "%s"},
                                            {NULL, "what", "%s"},
                                            {"threads", "threads", "%.0f"},
                                            {"mlups", "MLUPS", "%.1f"},
                                            {"over_one", "over one thread", "%.2f"}};
    result_table *t = RESULTS(columns);
    for (int what = 0; what < RATE_CASES && !common_interrupted(); what++) {
        const double one = rate(n, 0, (rate_case)what, 1, machine_seconds),
                     all = rate(n, 0, (rate_case)what, self->threads, machine_seconds);
        results_row(t, TEXTS(rate_keys[what], rate_names[what]), self->threads, all, all / one);
    }
    results_write(t, report, "speedups", self->out, "speedups.csv");
    results_free(t);
}

/* ---- a sphere that moves ---- */

/* A sphere of a diameter [cells] in a periodic box of n nodes of liquid at rest, which it crosses along z, a little
   aslant. speed: [cells a step]. */
typedef struct crossing {
    filtration_fluid fluid;
    double centre[3], velocity[3], spin[3], radius, force[3], torque[3];
    filtration_spheres spheres;
} crossing;

static filtration_status crossing_begin(crossing *c, int n, double diameter, double speed, double tau, double bulk,
                                        int walls) {
    filtration_fluid_def def = filtration_fluid_default_def();
    memset(c, 0, sizeof *c);
    def.nodes[0] = def.nodes[1] = def.nodes[2] = n;
    def.tau = tau, def.bulk_ratio = bulk;
    for (int f = 0; f < 6 && walls; f++) def.face[f] = FILTRATION_WALL;
    const filtration_status status = filtration_fluid_init(&c->fluid, &def);
    c->radius = 0.5 * diameter * def.voxel;
    for (int a = 0; a < 3; a++) c->centre[a] = (0.5 * n + 0.13 * (a + 1)) * def.voxel;
    c->velocity[0] = 0.11 * speed * def.voxel / c->fluid.dt, c->velocity[2] = speed * def.voxel / c->fluid.dt;
    const filtration_spheres s = {1, c->centre, c->velocity, c->spin, &c->radius, c->force, c->torque};
    c->spheres = s;
    return status;
}

static filtration_status crossing_step(crossing *c) {
    const filtration_status status = filtration_fluid_step(&c->fluid, &c->spheres);
    for (int a = 0; a < 3; a++) c->centre[a] += c->velocity[a] * c->fluid.dt;
    return status;
}

/* Standard deviation of n values about their straight line, over a size. */
static double flicker(int n, const double *y, double size) {
    double mean = 0.0, slope = 0.0, sum = 0.0;
    for (int i = 0; i < n; i++) mean += y[i] / n;
    for (int i = 0; i < n; i++) slope += (i - 0.5 * (n - 1)) * y[i] * 12.0 / ((double)n * n * n);
    for (int i = 0; i < n; i++) {
        const double off = y[i] - mean - slope * (i - 0.5 * (n - 1));
        sum += off * off / n;
    }
    return sqrt(sum) / fabs(size);
}

/* Drag and pressure over ten cells travelled, after forty. */
static void noise(const program *self, json *report) {
    enum { SPAN = 500 };
    static const double taus[] = {0.6, 1.0}, bulks[] = {2.0 / 3.0, 10.0, 100.0};
    static double drag[SPAN], pressure[SPAN];
    const int n = self->quick ? 24 : 40, lead = self->quick ? 100 : 2000;
    static const result_column columns[] = {
        {"tau", "relaxation time", "%.1f"},
        {"bulk_ratio", "bulk viscosity / nu", "%.3g"},
        {"drag_flicker", "drag flickers by [%]", "%.3f", 100.0},
        {"pressure_flicker_over_rho_u2|pressure_flicker", "pressure by [rho u^2]", "%.3f"}};
    result_table *r = RESULTS(columns);
    for (int t = 0; t < 2; t++)
        for (int b = 0; b < 3 && !common_interrupted(); b++) {
            crossing c;
            filtration_sample sample;
            filtration_status status = crossing_begin(&c, n, self->quick ? 9.0 : 15.0, 0.02, taus[t], bulks[b], 0);
            for (int k = 0; k < lead + SPAN && status == FILTRATION_OK; k++) {
                status = crossing_step(&c);
                if (k < lead) continue;
                drag[k - lead] = c.force[2];
                filtration_fluid_at(&c.fluid, 1, 1, n / 2, &sample);
                pressure[k - lead] = sample.pressure;
            }
            double mean = 0.0;
            for (int k = 0; k < SPAN; k++) mean += drag[k] / SPAN;
            const double of_drag = flicker(SPAN, drag, mean),
                         of_pressure = flicker(SPAN, pressure, c.fluid.def.density * c.velocity[2] * c.velocity[2]);
            filtration_fluid_free(&c.fluid);
            if (status != FILTRATION_OK) {
                common_fail("noise: %s", filtration_status_text(status));
                continue;
            }
            results_row(r, NULL, taus[t], bulks[b], of_drag, of_pressure);
        }
    results_write(r, report, "noise", self->out, "noise.csv");
    results_free(r);
}

/* Mass of the liquid in a closed box in which a sphere goes to and fro, over what the box and the sphere
   leave room for. */
static void masses(const program *self, json *report) {
    const int steps = self->quick ? 1000 : 100000, every = 100;
    double last[2] = {0.0, 0.0}, worst[2] = {0.0, 0.0}, added = 0.0;
    for (int keep = 0; keep < 2 && !common_interrupted(); keep++) {
        crossing c;
        filtration_status status = crossing_begin(&c, 24, 8.0, 0.02, 1.0, 2.0 / 3.0, 1);
        for (int k = 1; k <= steps && status == FILTRATION_OK; k++) {
            status = crossing_step(&c);
            if (k % 250 == 125) c.velocity[0] = -c.velocity[0], c.velocity[2] = -c.velocity[2];
            if (k % every || status != FILTRATION_OK) continue;
            if (keep) status = filtration_fluid_keep_mass(&c.fluid);
            const double v = c.fluid.def.voxel, room = c.fluid.def.density * 24.0 * 24.0 * 24.0 * v * v * v *
                                                       filtration_fluid_porosity(&c.fluid);
            last[keep] = filtration_fluid_mass(&c.fluid) / room - 1.0;
            worst[keep] = fmax(worst[keep], fabs(last[keep]));
        }
        if (status != FILTRATION_OK) common_fail("mass: %s", filtration_status_text(status));
        if (keep) added = c.fluid.mass_correction;
        filtration_fluid_free(&c.fluid);
    }
    common_print("Mass of the liquid after %d steps: off by %.2e (largest %.2e); kept every %d steps: %.1e, %.2e were "
                 "added in all\n",
                 steps, last[0], worst[0], every, worst[1], added);
    results_values(report, {"mass_steps", steps}, {"mass_drift", last[0]}, {"mass_drift_largest", worst[0]},
                   {"mass_kept_largest", worst[1]}, {"mass_added", added});
}

/* Ten diameters at a Mach number and a cell Reynolds number: how it ends. */
static void speeds(const program *self, json *report) {
    static const double machs[] = {0.1, 0.2, 0.3}, cells[] = {5.0, 20.0, 40.0};
    const double diameter = self->quick ? 6.0 : 15.0;
    static const result_column columns[] = {{"mach", "Mach", "%.1f"},
                                            {"cell_reynolds", "u dx / nu", "%.0f"},
                                            {"tau", "relaxation time", "%.4f"},
                                            {NULL, "ends with", "%s"},
                                            {"end", NULL, "%s"},
                                            {"steps", "step", "%.0f"},
                                            {"of_steps", "of", "%.0f"}};
    result_table *t = RESULTS(columns);
    for (int m = 0; m < 3; m++)
        for (int r = 0; r < 3 && !common_interrupted(); r++) {
            crossing c;
            const double speed = machs[m] / sqrt(3.0), tau = 0.5 + 3.0 * speed / cells[r];
            const int steps = (int)(10.0 * diameter / speed);
            int done = 0;
            filtration_status status = crossing_begin(&c, self->quick ? 16 : 40, diameter, 0.0, tau, 2.0 / 3.0, 0);
            for (; done < steps && status == FILTRATION_OK; done++) { /* from rest, as nothing starts at once */
                const double ramp = done < steps / 5 ? 5.0 * done / steps : 1.0;
                c.velocity[2] = ramp * speed * c.fluid.def.voxel / c.fluid.dt, c.velocity[0] = 0.11 * c.velocity[2];
                status = crossing_step(&c);
            }
            const char *end = status == FILTRATION_OK ? "ok" : filtration_status_text(status);
            results_row(t, TEXTS(end, status == FILTRATION_DIVERGED ? "stopped, with place and cause" : end), machs[m],
                        cells[r], tau, done, steps);
            filtration_fluid_free(&c.fluid);
        }
    results_print(t);
    results_json(t, report, "speeds");
    results_free(t);
}

int main(int argc, char **argv) {
    enum { ALL, DRAG, RATES, MOVING, SPEEDUPS };
    int part = ALL;
    option options[] = {option_choice(
        "part", &part, "all|drag|rates|moving|speedups",
        "drag of the array, rate of the lattice, a sphere that moves, all three; or the rates on --threads over one")};
    program self = program_start(
        "bench_filtration",
        "Drag of a periodic array: error against run time; rate of the lattice against memory; a sphere that moves.",
        options, 1, argc, argv);
    json *report = json_open(self.json);
    if (part == ALL || part == DRAG) drag_errors(&self, report);
    if (part == ALL || part == RATES) rates(&self, report);
    if (part == SPEEDUPS) speedups(&self, report);
    if (part == ALL || part == MOVING) {
        noise(&self, report);
        masses(&self, report);
        speeds(&self, report);
    }
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
