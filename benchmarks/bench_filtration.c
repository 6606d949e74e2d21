/* filtration.h: error against run time, and the rate of the kernel.

   1. Drag of a simple cubic array of spheres (solid volume fraction 0.125, K = 4.2916, Zick and Homsy 1982): largest error of four places
      of the centre within a voxel against processor time, over voxel, lattice, precision, boundary and relaxation time.
   2. Node updates a second, bare and with one moving sphere, against the limit of memory: every population of the same memory read, changed
      and written back, in the same run. */
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

enum { VARIANTS = 6, SIZES = 3 };
static const variant variants[VARIANTS] = {
    {"D3Q19 double, central linear, tau 1", "q19_double_linear_tau1", FILTRATION_D3Q19, FILTRATION_DOUBLE, FILTRATION_CENTRAL_LINEAR, 1.0},
    {"D3Q19 double, central linear, tau 3.5", "q19_double_linear_tau3.5", FILTRATION_D3Q19, FILTRATION_DOUBLE, FILTRATION_CENTRAL_LINEAR,
     3.5},
    {"D3Q19 float, central linear, tau 3.5", "q19_float_linear_tau3.5", FILTRATION_D3Q19, FILTRATION_FLOAT, FILTRATION_CENTRAL_LINEAR, 3.5},
    {"D3Q15 double, central linear, tau 3.5", "q15_double_linear_tau3.5", FILTRATION_D3Q15, FILTRATION_DOUBLE, FILTRATION_CENTRAL_LINEAR,
     3.5},
    {"D3Q19 double, half-way, tau 1", "q19_double_half_tau1", FILTRATION_D3Q19, FILTRATION_DOUBLE, FILTRATION_HALF_WAY, 1.0},
    {"D3Q19 double, half-way, tau 3.5", "q19_double_half_tau3.5", FILTRATION_D3Q19, FILTRATION_DOUBLE, FILTRATION_HALF_WAY, 3.5},
};
static const int sizes[SIZES] = {12, 16, 24};
static const double places[4][3] = {{0, 0, 0}, {0.25, 0.25, 0.25}, {0.5, 0.5, 0.5}, {0.1, 0.3, 0.45}};

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
    const double began = machine_processor_seconds();
    filtration_status status = filtration_fluid_init(&fluid, &def);
    if (status == FILTRATION_OK) status = filtration_fluid_permeability(&fluid, &spheres, 2, 100.0 * side, 1e-5, 1000000, &result);
    filtration_fluid_free(&fluid);
    if (status != FILTRATION_OK) return common_fail("%s", filtration_status_text(status));
    *seconds = machine_processor_seconds() - began;
    *drag = 100.0 * side * side * side / (6.0 * 3.14159265358979323846 * def.viscosity * radius * result.velocity);
    return 0;
}

static void drag_errors(const program *self, json *report) {
    double error[VARIANTS][SIZES], time[VARIANTS][SIZES];
    const int count = self->quick ? 2 : SIZES, last = self->quick ? 1 : 4;
    table out = table_begin("method|cells a diameter|largest error [%]|time [s]");
    csv *file = csv_open(self->out, "drag.csv", "method,cells_per_diameter,largest_error,seconds");
    json_array_begin(report, "drag");
    for (int s = 0; s < count; s++)
        for (int v = 0; v < VARIANTS && !common_interrupted(); v++) {
            const double cells = 2.0 * cbrt(3.0 * 0.125 / (4.0 * 3.14159265358979323846)) * sizes[s];
            double worst = 0.0, least = HUGE_VAL;
            for (int p = 0; p < last; p++) {
                double drag, seconds;
                if (array_drag(&variants[v], sizes[s], places[p], &drag, &seconds)) return;
                worst = fmax(worst, fabs(drag / 4.2916 - 1.0));
                least = fmin(least, seconds); /* the least disturbed one */
            }
            error[v][s] = worst;
            time[v][s] = least;
            table_cell(&out, "%s", variants[v].name);
            table_cell(&out, "%.1f", cells);
            table_cell(&out, "%.3f", 100.0 * worst);
            table_cell(&out, "%.3f", least);
            csv_line(file, "%s,%.4g,%.6g,%.6g", variants[v].key, cells, worst, least);
            json_object_begin(report, NULL);
            json_string(report, "method", variants[v].key);
            json_number(report, "cells_per_diameter", cells);
            json_number(report, "largest_error", worst);
            json_number(report, "processor_s", least);
            json_object_end(report);
        }
    json_array_end(report);
    table_end(&out);
    csv_close(file);
    if (common_interrupted()) return;
    plot *figure = plot_new("Simple cubic array, c = 0.125: error of the drag against run time", 1, 1);
    plot_panel_size(figure, 560, 380);
    plot_panel(figure, 0, 0, "processor time to the steady flow [s]", "largest error of the drag, four places of the centre [-]");
    plot_log_x(figure);
    plot_log_y(figure);
    for (int v = 0; v < VARIANTS; v++) {
        plot_line(figure, variants[v].name, time[v], error[v], count);
        plot_style(figure, PLOT_MARKED | (v > 3 ? PLOT_DASHED : 0), v);
    }
    plot_legend_outside(figure);
    plot_write(figure, self->out, "drag.svg");
}

/* Millions of nodes a second that a pass over as many populations in place allows. */
static double memory_limit(int n, int single) {
    const size_t size = (size_t)n * (size_t)n * (size_t)n * 19;
    double best = HUGE_VAL;
    void *block = calloc(size, single ? sizeof(float) : sizeof(double));
    if (!block) return (double)NAN;
    for (int pass = 0; pass < 6; pass++) {
        const double began = machine_processor_seconds();
        if (single)
            for (size_t k = 0; k < size; k++) ((float *)block)[k] = ((float *)block)[k] * 0.5f + 1e-3f;
        else
            for (size_t k = 0; k < size; k++) ((double *)block)[k] = ((double *)block)[k] * 0.5 + 1e-3;
        const double spent = machine_processor_seconds() - began;
        if (pass > 0 && spent < best) best = spent; /* the first one finds the pages */
    }
    const double check = single ? (double)((float *)block)[size / 2] : ((double *)block)[size / 2];
    free(block);
    return check > 0.0 ? (double)(size / 19) / best * 1e-6 : (double)NAN;
}

/* Millions of node updates a second; a sphere of 20 cells that drifts, or none. */
static double rate(int n, int single, int bulk, int sphere) {
    filtration_fluid_def def = filtration_fluid_default_def();
    filtration_fluid fluid;
    double centre[3], velocity[3], spin[3] = {0, 0, 0}, radius = 10.0 * def.voxel, force[3], torque[3], best = HUGE_VAL;
    def.nodes[0] = def.nodes[1] = def.nodes[2] = n;
    def.precision = single ? FILTRATION_FLOAT : FILTRATION_DOUBLE;
    def.skip = 0;
    if (bulk) def.bulk_ratio = 20.0;
    if (filtration_fluid_init(&fluid, &def) != FILTRATION_OK) return (double)NAN;
    for (int a = 0; a < 3; a++) centre[a] = (0.5 * n + 0.13 * a) * def.voxel, velocity[a] = 0.003 * def.voxel / fluid.dt;
    const filtration_spheres spheres = {sphere, centre, velocity, spin, &radius, force, torque};
    for (int round = 0; round < 5; round++) {
        const double began = machine_processor_seconds();
        for (int k = 0; k < 4; k++) {
            if (filtration_fluid_step(&fluid, &spheres) != FILTRATION_OK) best = (double)NAN;
            for (int a = 0; a < 3; a++) centre[a] += velocity[a] * fluid.dt;
        }
        const double spent = machine_processor_seconds() - began;
        if (round > 0 && spent < best) best = spent;
    }
    filtration_fluid_free(&fluid);
    return 4e-6 * n * n * n / best;
}

static void rates(const program *self, json *report) {
    const int n = self->quick ? 64 : 128;
    table out = table_begin("precision|limit [MLUPS]|bare|bulk viscosity|one moving sphere|bare over limit [%]");
    csv *file = csv_open(self->out, "rates.csv", "precision,limit_mlups,bare_mlups,bulk_mlups,sphere_mlups");
    for (int single = 0; single < 2 && !common_interrupted(); single++) {
        const double limit = memory_limit(n, single), bare = rate(n, single, 0, 0), bulk = rate(n, single, 1, 0),
                     sphere = rate(n, single, 0, 1);
        table_cell(&out, single ? "float" : "double");
        table_cell(&out, "%.0f", limit);
        table_cell(&out, "%.0f", bare);
        table_cell(&out, "%.0f", bulk);
        table_cell(&out, "%.0f", sphere);
        table_cell(&out, "%.0f", 100.0 * bare / limit);
        csv_line(file, "%s,%.4g,%.4g,%.4g,%.4g", single ? "float" : "double", limit, bare, bulk, sphere);
        json_number(report, single ? "float_limit_mlups" : "double_limit_mlups", limit);
        json_number(report, single ? "float_mlups" : "double_mlups", bare);
        json_number(report, single ? "float_bulk_mlups" : "double_bulk_mlups", bulk);
        json_number(report, single ? "float_sphere_mlups" : "double_sphere_mlups", sphere);
    }
    table_end(&out);
    csv_close(file);
}

int main(int argc, char **argv) {
    program self = program_start(
        "bench_filtration", "Drag of a periodic array: error against run time; rate of the lattice against memory.", NULL, 0, argc, argv);
    json *report = json_open(self.json);
    drag_errors(&self, report);
    rates(&self, report);
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
