/* filtration.h: the physics of the resolved fluid in one table, each case against an exact or measured result: cells a
   diameter, error, processor time.

   arrays        drag of simple cubic, body-centred and face-centred arrays of spheres: Sangani and Acrivos (1982,
                 series), Hasimoto (1959); touching: Zick and Homsy (1982); two places of the array within a voxel, the
                 larger error
   random        pack of random places, mean of three: van der Hoef, Beetstra and Kuipers (2005), a fit to simulations
   two spheres   that approach each other, exact series (Brenner 1961), gaps of 0.3, 0.7 and 1.2 cells, four places and
                 directions: largest error
   wall          a sphere that approaches a wall, the same
   shear         a sphere free to turn between two plates that slide: its spin against half of the shear rate
   frame         drag of a sphere that moves against one at rest in the same flow
   E1 to E4      spheres of 15 mm that settle: ten Cate et al. (2002), the largest velocity measured; a quarter of the
                 box between mirrors */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "filtration.h"
#include "random.h"

static const result_column columns[] = {{"case", "case", "%s"},
                                        {"cells_per_diameter", "cells a diameter", "%.3g"},
                                        {"tau", "relaxation time", "%.3g"},
                                        {"error", "error [%]", "%+.2f", 100.0},
                                        {"processor_s|seconds", "time [s]", "%.2f"}};

static void add_row(result_table *t, const char *what, double cells, double tau, double error, double seconds) {
    results_row(t, TEXTS(what), cells, tau, error, seconds);
}

/* A fluid in units of the lattice: voxel, density and time step 1. */
static filtration_fluid_def lattice_def(int x, int y, int z, double tau) {
    filtration_fluid_def def = filtration_fluid_default_def();
    def.nodes[0] = x, def.nodes[1] = y, def.nodes[2] = z;
    def.voxel = def.density = 1.0, def.tau = tau, def.viscosity = (tau - 0.5) / 3.0;
    return def;
}

static double larger_of(double a, double b) { return fabs(a) < fabs(b) || b != b ? b : a; }

/* ---- periodic arrays ---- */

enum { MOST = 64 };
typedef struct pack {
    int n;
    double side, radius, centre[3 * MOST];
} pack;

/* Force on a sphere over 6 pi mu R times the superficial velocity; NaN after an error. */
static double drag_of(const pack *p, double tau) {
    static double zero[3 * MOST], force[3 * MOST], torque[3 * MOST], radius[MOST];
    const int n = (int)(p->side + 0.5);
    const filtration_fluid_def def = lattice_def(n, n, n, tau);
    filtration_fluid fluid;
    filtration_permeability_result result;
    double centre[3 * MOST];
    memcpy(centre, p->centre, sizeof centre);
    for (int i = 0; i < p->n; i++) radius[i] = p->radius;
    const filtration_spheres spheres = {p->n, centre, zero, zero, radius, force, torque};
    filtration_status status = filtration_fluid_init(&fluid, &def);
    if (status == FILTRATION_OK)
        status = filtration_fluid_permeability(&fluid, &spheres, 2, 1e-7 * p->side, 1e-5, 1000000, &result);
    filtration_fluid_free(&fluid);
    if (status != FILTRATION_OK) return (double)NAN;
    return 1e-7 * p->side * p->side * p->side / p->n / (6.0 * RIDDLE_PI * def.viscosity * p->radius * result.velocity);
}

static double array_error(int spheres, double solid, double drag, int n, double tau, double place) {
    static const double at[4][3] = {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}};
    pack p = {spheres, n, n * cbrt(3.0 * solid / (4.0 * RIDDLE_PI * spheres)), {0}};
    for (int i = 0; i < spheres; i++)
        for (int a = 0; a < 3; a++)
            p.centre[3 * i + a] = n * (0.25 + (spheres == 2 ? 0.5 * i : at[i][a])) + place * (0.6 + 0.2 * a);
    return drag_of(&p, tau) / drag - 1.0;
}

typedef struct array_case {
    const char *name;
    int spheres;
    double solid, drag;
} array_case;

static void arrays(const program *self, result_table *t, double tau) {
    static const array_case cases[] = {
        {"simple cubic 0.125", 1, 0.125, 4.2916},          {"simple cubic 0.216", 1, 0.216, 7.442},
        {"body-centred 0.125", 2, 0.125, 4.4464},          {"body-centred 0.216", 2, 0.216, 7.7388},
        {"face-centred 0.064", 4, 0.064, 2.8895},          {"simple cubic touching", 1, 0.5235987755, 42.14},
        {"body-centred touching", 2, 0.6801747615, 162.9}, {"face-centred touching", 4, 0.7404804896, 435.0}};
    static const int cells[2][3] = {{8, 16, 24}, {8, 12, 16}}; /* touching arrays take long to become steady */
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
        for (int c = 0; c < (self->quick ? 1 : 3) && !common_interrupted(); c++) {
            const array_case *a = &cases[k];
            if (a->spheres == 4 && k > 4 && c == 2) continue;
            const double per_side = cbrt(6.0 * a->solid / (RIDDLE_PI * a->spheres)); /* diameter over side */
            const int n = (int)(cells[k > 4][c] / per_side + 0.5), once = self->quick || k > 4;
            const double began = machine_processor_seconds(),
                         first = array_error(a->spheres, a->solid, a->drag, n, tau, 0.0);
            const double second = once ? first : array_error(a->spheres, a->solid, a->drag, n, tau, 0.5);
            add_row(t, a->name, n * per_side, tau, larger_of(first, second),
                    (machine_processor_seconds() - began) / (once ? 1 : 2));
        }
}

/* Spheres at random places where they overlap none. */
static pack random_pack(int n, double solid, int side, uint64_t seed) {
    pack p = {0, side, side * cbrt(3.0 * solid / (4.0 * RIDDLE_PI * n)), {0}};
    while (p.n < n) {
        double *x = p.centre + 3 * p.n;
        int is_free = 1;
        for (int a = 0; a < 3; a++) x[a] = side * random_inner(&seed);
        for (int k = 0; k < p.n && is_free; k++) {
            double square = 0.0;
            for (int a = 0; a < 3; a++) {
                double d = x[a] - p.centre[3 * k + a];
                d -= side * floor(d / side + 0.5);
                square += d * d;
            }
            is_free = square >= 4.0 * p.radius * p.radius;
        }
        p.n += is_free;
    }
    return p;
}

static void random_packs(const program *self, result_table *t, double tau) {
    static const int sides[] = {32, 48};
    const double solid = 0.25, exact = 10.0 * solid / (1 - solid) / (1 - solid) +
                                       (1 - solid) * (1 - solid) * (1.0 + 1.5 * sqrt(solid));
    const int n = 24, seeds = self->quick ? 1 : 3;
    for (int c = 0; c < (self->quick ? 1 : 2) && !common_interrupted(); c++) {
        const double began = machine_processor_seconds();
        double mean = 0.0, cells = 0.0;
        for (int seed = 0; seed < seeds; seed++) {
            const pack p = random_pack(n, solid, sides[c], (uint64_t)seed + 1);
            mean += (1.0 - solid) * drag_of(&p, tau) / seeds, cells = 2.0 * p.radius;
        }
        add_row(t, "random pack 0.25", cells, tau, mean / exact - 1.0, (machine_processor_seconds() - began) / seeds);
    }
}

/* ---- two spheres, a wall ---- */

/* Force on a sphere that approaches a wall, or its mirror image, over Stokes's (Brenner 1961); a: cosh a is the
   distance over the radius. */
static double brenner(double a, int wall) {
    double sum = 0.0;
    for (int n = 1; n < 5000 && (2 * n + 1) * a < 600.0; n++) {
        const double m = 2 * n + 1, flat = m * sinh(a), even = m * sinh(2.0 * a);
        const double term = wall ? (2.0 * sinh(m * a) + even) / (4.0 * pow(sinh(0.5 * m * a), 2) - flat * flat) - 1.0
                                 : (4.0 * pow(cosh(0.5 * m * a), 2) + flat * flat) / (2.0 * sinh(m * a) - even) - 1.0;
        sum += n * (n + 1.0) / ((2.0 * n - 1.0) * (2.0 * n + 3.0)) * term;
    }
    return 4.0 / 3.0 * sinh(a) * sum;
}

static double approach_error(double cells, double h, int wall, const double along[3], const double place[3],
                             double tau) {
    const double R = 0.5 * cells, v = 1e-5,
                 unit = sqrt(along[0] * along[0] + along[1] * along[1] + along[2] * along[2]);
    const int n = (int)(4.0 * cells);
    filtration_fluid_def def = lattice_def(n, n, n, tau);
    filtration_fluid fluid;
    double centre[6], velocity[6], spin[6] = {0}, radius[2] = {R, R}, force[6], torque[6], towards = 0.0;
    const filtration_spheres spheres = {wall ? 1 : 2, centre, velocity, spin, radius, force, torque};
    if (wall) def.face[FILTRATION_LOW_Z] = def.face[FILTRATION_HIGH_Z] = FILTRATION_WALL;
    for (int a = 0; a < 3; a++) {
        const double e = along[a] / unit, middle = 0.5 * n + place[a];
        centre[a] = middle - e * (R + 0.5 * h), centre[3 + a] = middle + e * (R + 0.5 * h);
        velocity[a] = (wall ? 1.0 : 0.5) * v * e, velocity[3 + a] = -0.5 * v * e;
    }
    if (wall) centre[2] = n - R - h;
    filtration_status status = filtration_fluid_init(&fluid, &def);
    if (status == FILTRATION_OK)
        status = filtration_fluid_run(&fluid, (int64_t)(0.6 * cells * cells / def.viscosity) * 2, &spheres);
    filtration_fluid_free(&fluid);
    if (status != FILTRATION_OK) return (double)NAN;
    for (int a = 0; a < 3; a++) towards += (wall ? -force[a] : 0.5 * (force[3 + a] - force[a])) * along[a] / unit;
    towards += filtration_lubrication_force(R, wall ? HUGE_VAL : R, h, v, def.viscosity, 2.0 / 3.0, 1e-9);
    const double exact = 6.0 * RIDDLE_PI * def.viscosity * R * v *
                         (wall ? brenner(acosh(1.0 + h / R), 1) : 0.5 * brenner(acosh(1.0 + 0.5 * h / R), 0));
    return towards / exact - 1.0;
}

static void approaches(const program *self, result_table *t, double tau) {
    static const double gaps[] = {0.3, 0.7, 1.2}, ways[4][3] = {{0, 0, 1}, {1, -1, 0}, {1, 1, 1}, {0.3, -1, 0.6}},
                        places[4][3] = {{0, 0, 0}, {0.5, 0.5, 0.5}, {0.1, 0.3, 0.45}, {0.25, 0.75, 0.6}};
    static const double cells[] = {8, 12, 16, 24};
    for (int wall = 0; wall < 2; wall++)
        for (int c = 0; c < (self->quick ? 1 : 4) && !common_interrupted(); c++) {
            const double began = machine_processor_seconds();
            const int tries = self->quick || c == 3 ? 1 : 4;
            double worst = 0.0;
            for (int g = 0; g < (c == 3 ? 2 : 3); g++)
                for (int k = 0; k < tries; k++)
                    worst = larger_of(worst, approach_error(cells[c], gaps[g], wall, wall ? ways[0] : ways[k],
                                                            places[(k + g) % 4], tau));
            add_row(t, wall ? "sphere towards a wall" : "two spheres approach", cells[c], tau, worst,
                    (machine_processor_seconds() - began) / ((c == 3 ? 2 : 3) * tries)); /* 24 cells take long */
        }
}

/* ---- shear, frame ---- */

/* Spin of a sphere free to turn, over half of the shear rate, less 1; and nothing is assumed but that the torque is
   linear in the spin. */
static double shear_error(double cells, double tau) {
    const double R = 0.5 * cells, rate = 1e-5;
    const int n = (int)(4.0 * cells);
    double torques[2] = {0.0, 0.0};
    for (int turns = 0; turns < 2; turns++) {
        filtration_fluid_def def = lattice_def(n, n, n, tau);
        filtration_fluid fluid;
        double centre[3] = {0.5 * n + 0.3, 0.5 * n + 0.1, 0.5 * n}, zero[3] = {0, 0, 0}, spin[3] = {0, 0, 0}, r = R,
               force[3], torque[3];
        const filtration_spheres spheres = {1, centre, zero, spin, &r, force, torque};
        def.face[FILTRATION_LOW_Z] = def.face[FILTRATION_HIGH_Z] = FILTRATION_WALL;
        def.face_velocity[FILTRATION_LOW_Z][0] = -0.5 * n * rate,
        def.face_velocity[FILTRATION_HIGH_Z][0] = 0.5 * n * rate;
        if (turns) spin[1] = 0.5 * rate;
        if (filtration_fluid_init(&fluid, &def) != FILTRATION_OK) return (double)NAN;
        if (filtration_fluid_run(&fluid, (int64_t)(0.5 * n * n / def.viscosity), &spheres) == FILTRATION_OK)
            torques[turns] = torque[1];
        filtration_fluid_free(&fluid);
    }
    return torques[0] / (torques[0] - torques[1]) - 1.0;
}

static void uniform_flow(void *user, const double x[3], double u[3], double *p) {
    (void)x;
    u[0] = u[1] = 0.0, u[2] = *(const double *)user, *p = 0.0;
}

/* Drag over slip of a sphere that moves through ten cells, in an array. */
static double drag_over_slip(double cells, double tau, double speed) {
    const double R = 0.5 * cells;
    const int n = (int)(2.4 * cells), span = 500, lead = (int)(8.0 * n * n / (tau - 0.5) / 3.0);
    filtration_fluid_def def = lattice_def(n, n, n, tau);
    filtration_fluid fluid;
    double centre[3] = {0.5 * n + 0.13, 0.5 * n + 0.27, 0.5 * n + 0.4}, velocity[3] = {0, 0, speed},
           zero[3] = {0, 0, 0}, r = R, force[3], torque[3], drag = 0.0, slip = 0.0;
    const filtration_spheres spheres = {1, centre, velocity, zero, &r, force, torque};
    const double porosity = 1.0 - 4.0 / 3.0 * RIDDLE_PI * R * R * R / ((double)n * n * n);
    def.body_force[2] = 1e-5 * def.viscosity;
    if (filtration_fluid_init(&fluid, &def) != FILTRATION_OK) return (double)NAN;
    if (speed != 0.0) filtration_fluid_set_flow(&fluid, uniform_flow, &speed);
    for (int k = 0; k < lead + span; k++) {
        double mean[3];
        if (filtration_fluid_step(&fluid, &spheres) != FILTRATION_OK) drag = (double)NAN;
        centre[2] += speed;
        if (k < lead) continue;
        drag += force[2];
        if (k % 10) continue;
        filtration_fluid_mean_velocity(&fluid, mean);
        slip += mean[2] - porosity * speed;
    }
    filtration_fluid_free(&fluid);
    return drag / slip;
}

static void shear_and_frame(const program *self, result_table *t, double tau) {
    static const double cells[] = {8, 12};
    for (int c = 0; c < (self->quick ? 1 : 2) && !common_interrupted(); c++) {
        const double began = machine_processor_seconds(), error = shear_error(cells[c], tau);
        add_row(t, "spin in a shear flow", cells[c], tau, error, machine_processor_seconds() - began);
    }
    for (int c = 0; c < (self->quick ? 1 : 2) && !common_interrupted(); c++) {
        const double began = machine_processor_seconds(),
                     error = drag_over_slip(cells[c], 1.0, -0.02) / drag_over_slip(cells[c], 1.0, 0.0) - 1.0;
        add_row(t, "moving or at rest", cells[c], 1.0, error, machine_processor_seconds() - began);
    }
}

/* ---- ten Cate's spheres ---- */

/* Largest velocity over the one measured, less 1. */
static double settling_error(double density, double viscosity, double measured, double cells, double *tau) {
    const double D = 15e-3, voxel = D / cells, speed = 0.02, dt = speed * voxel / measured;
    filtration_fluid_def def = filtration_fluid_default_def();
    filtration_motion_def motion = filtration_motion_default_def();
    filtration_fluid fluid;
    double centre[3] = {0, 0, 0.1275}, velocity[3] = {0, 0, 0}, spin[3] = {0, 0, 0}, radius = 0.5 * D, force[3],
           torque[3], largest = 0.0;
    filtration_spheres spheres = {1, centre, velocity, spin, &radius, force, torque};
    def.voxel = voxel, def.density = density, def.viscosity = viscosity;
    def.tau = *tau = fmax(0.5 + 3.0 * viscosity / density * dt / (voxel * voxel), 0.55);
    def.bulk_ratio = 10.0;
    for (int f = 0; f < 6; f++) def.face[f] = FILTRATION_WALL;
    def.face[FILTRATION_LOW_X] = def.face[FILTRATION_LOW_Y] = FILTRATION_SYMMETRY;
    def.nodes[0] = def.nodes[1] = (int)(0.05 / voxel + 0.5), def.nodes[2] = (int)(0.16 / voxel + 0.5);
    motion.density = 1120.0, motion.spin = 0;
    motion.fixed_axes[0] = motion.fixed_axes[1] = 1;
    if (filtration_fluid_init(&fluid, &def) != FILTRATION_OK) return (double)NAN;
    while (centre[2] > D && fluid.time < 10.0) {
        if (filtration_fluid_step(&fluid, &spheres) != FILTRATION_OK ||
            filtration_move(&motion, &fluid, &spheres, 4.0, NULL) != FILTRATION_OK)
            largest = (double)NAN;
        if (!(-velocity[2] <= largest)) largest = -velocity[2];
        if (common_interrupted() || !(largest < 1.0)) break;
    }
    filtration_fluid_free(&fluid);
    return largest / measured - 1.0;
}

static void ten_cate(const program *self, result_table *t) {
    static const double density[] = {970, 965, 962, 960}, viscosity[] = {0.373, 0.212, 0.113, 0.058},
                        measured[] = {0.035986, 0.05718, 0.087269, 0.12224}, cells[] = {6, 9};
    static const char *const names[] = {"settling E1", "settling E2", "settling E3", "settling E4"};
    for (int k = self->quick ? 3 : 0; k < 4; k++)
        for (int c = 0; c < (self->quick ? 1 : 2) && !common_interrupted(); c++) {
            double tau = 0.0;
            const double began = machine_processor_seconds(),
                         error = settling_error(density[k], viscosity[k], measured[k], cells[c], &tau);
            add_row(t, names[k], cells[c], tau, error, machine_processor_seconds() - began);
        }
}

int main(int argc, char **argv) {
    enum { ALL, ARRAYS, PAIRS, MOVING, SETTLING };
    double tau = 3.5;
    int part = ALL;
    option options[] = {
        option_choice("part", &part, "all|arrays|pairs|moving|settling",
                      "arrays and packs, approaching spheres, shear and frame, ten Cate's, or all"),
        option_positive("tau", "TAU", &tau, 5.0, "relaxation time of the creeping flows [-], above 0.5; default 3.5"),
    };
    program self = program_start("bench_fluid_physics",
                                 "The physics of the resolved fluid: error and processor time of each case.", options,
                                 2, argc, argv);
    if (!(tau > 0.5)) program_refuse(&self, "tau", NULL, "a number above 0.5 and at most 5");
    result_table *t = RESULTS(columns);
    json *report = json_open(self.json);
    if (part == ALL || part == ARRAYS) arrays(&self, t, tau), random_packs(&self, t, tau);
    if (part == ALL || part == PAIRS) approaches(&self, t, tau);
    if (part == ALL || part == MOVING) shear_and_frame(&self, t, tau);
    if (part == ALL || part == SETTLING) ten_cate(&self, t);
    results_write(t, report, "cases", self.out, "physics.csv");
    riddle_plot *figure = riddle_plot_new("The resolved fluid: error of each case", 1, 1);
    riddle_plot_panel(figure, 0, 0, "cells a diameter", "error [%]");
    riddle_plot_points(figure, NULL, results_column(t, "cells_per_diameter", 1.0), results_column(t, "error", 100.0),
                       results_rows(t));
    riddle_plot_horizontal(figure, NULL, 0.0);
    riddle_plot_write(figure, self.out, "physics.svg");
    results_free(t);
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
