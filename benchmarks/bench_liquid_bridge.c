/* liquid_bridge.h: error against Young-Laplace versus time.

   1. The capillary force of one bridge: closed-form laws, and series of 2 to 9 terms in tau (the header keeps 7), over
      four kinds of pair of the wet screen, volumes V/R_h^3 from 1e-5 to 0.02, gaps to 0.9 of rupture. Time is that of
      one evaluation among 4096 bridges in random order.
   2. What else a step or a formation calls: all forces at once, rupture test, forming, allocating, and the solver
      itself.
   3. The tables: deviation that bridge_pair_prepare measured itself. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "liquid_bridge.h"

enum { KINDS = 4, BRIDGES = 4096, ORDERS = 8, SAMPLES = 40, CHECKS = 30 };

static const double sigma = 0.07275;
static volatile double sink; /* so that no loop is left out */

static bridge_pair_def kind_def(int kind) {
    bridge_pair_def def = bridge_pair_default_def();
    const double rj[KINDS] = {2.5e-3, 5e-3, (double)INFINITY, (double)INFINITY},
                 ri[KINDS] = {2.5e-3, 2.5e-3, 2.5e-3, 5e-3};
    def.radius_i = ri[kind];
    def.radius_j = rj[kind];
    def.angle_j = (kind < 2 ? 15.0 : 45.0) * RIDDLE_PI / 180.0;
    def.volume_max = 0.02;
    return def;
}

static const char *const kind_names[KINDS] = {"5 + 5 mm, 15/15", "5 + 10 mm, 15/15", "5 mm + plate, 15/45",
                                              "10 mm + plate, 15/45"};

/* ---- what is evaluated ---- */

typedef struct sample {
    bridge b;
    double gap, velocity, angle_i, angle_j, mean_angle;
} sample;

static sample samples[BRIDGES];

/* Series of n terms over X, n a constant where it is called. */
static inline double series_force(const double *c, int n, double rupture_gap, double a, double gap) {
    double tau = sqrt(rupture_gap - gap), h = sqrt(gap * gap + a), sum = c[n - 1];
    for (int k = n - 2; k >= 0; k--) sum = sum * tau + c[k];
    return sum * a / (h * (h + gap));
}

static double law_table(const sample *s) { return bridge_attraction(&s->b, s->gap); }
static double law_energy(const sample *s) {
    return bridge_force_energy(s->gap, s->b.volume, s->b.radius, s->angle_i, s->angle_j, sigma);
}
static double law_simple(const sample *s) {
    return bridge_force_willett_simple(s->gap, s->b.volume, s->b.radius, s->angle_i, s->angle_j, sigma);
}
static double law_willett(const sample *s) {
    return bridge_force_willett(s->gap, s->b.volume, s->b.radius, s->mean_angle, sigma);
}
static double law_corrected(const sample *s) {
    return bridge_force_tension(s->gap, s->b.volume, s->b.radius, s->angle_i, s->angle_j, sigma);
}
static double law_printed(const sample *s) {
    return bridge_printed_force(s->gap, s->b.volume, s->b.radius, s->angle_i, s->angle_j, sigma);
}

typedef struct law {
    const char *name;
    double (*force)(const sample *);
} law;

static const law laws[] = {{"energy form", law_energy},        {"Willett, simple", law_simple},
                           {"Willett, full", law_willett},     {"eq 12, corrected", law_corrected},
                           {"eq 12, as printed", law_printed}, {"table of the header (7 terms)", law_table}};
enum { LAWS = sizeof laws / sizeof *laws };

/* ns of one evaluation: the quickest of some passes. The call through a pointer costs every law the same. */
#define TIME(result, passes, expression)                                                                               \
    do {                                                                                                               \
        double quickest = HUGE_VAL;                                                                                    \
        for (int pass = 0; pass < (passes); pass++) {                                                                  \
            double began = machine_seconds(), sum = 0.0;                                                               \
            for (int k = 0; k < BRIDGES; k++) sum += (expression);                                                     \
            sink = sum;                                                                                                \
            quickest = fmin(quickest, machine_seconds() - began);                                                      \
        }                                                                                                              \
        (result) = 1e9 * quickest / BRIDGES;                                                                           \
    } while (0)

/* ---- 1: laws and series ---- */

/* Least relative squares of n terms through Young-Laplace solutions, gaps in units of rupture. */
static int fit_series(int n, const double *gap, const double *force, int m, double rupture_gap, double a, double *c) {
    double normal[ORDERS + 2][ORDERS + 3] = {{0}};
    for (int s = 0; s < m; s++) {
        double tau = sqrt(1.0 - gap[s] / rupture_gap), row[ORDERS + 2], x = bridge_neck_factor(gap[s], a) / force[s];
        for (int k = 0; k < n; k++, x *= tau) row[k] = x;
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++) normal[i][j] += row[i] * row[j];
            normal[i][n] += row[i];
        }
    }
    for (int k = 0; k < n; k++) { /* Gauss-Jordan; the matrix is positive definite */
        if (!(normal[k][k] > 0.0)) return -1;
        for (int i = 0; i < n; i++) {
            if (i == k) continue;
            double f = normal[i][k] / normal[k][k];
            for (int j = k; j <= n; j++) normal[i][j] -= f * normal[k][j];
        }
    }
    for (int k = 0; k < n; k++) c[k] = normal[k][n] / normal[k][k] * pow(rupture_gap, -0.5 * k);
    return 0;
}

typedef struct accuracy {
    double worst, square;
    long n;
} accuracy;

static void note(accuracy *a, double got, double wanted) {
    double off = fabs(got / wanted - 1.0);
    if (off > a->worst) a->worst = off;
    a->square += off * off;
    a->n++;
}

static void measure_errors(int volumes, accuracy *of_law, accuracy *of_series, progress *bar) {
    for (int kind = 0; kind < KINDS; kind++) {
        bridge_pair_def def = kind_def(kind);
        bridge_pair pair;
        if (bridge_pair_prepare(&pair, &def) != BRIDGE_OK) {
            common_fail("kind %d cannot be prepared", kind);
            return;
        }
        for (int v = 0; v < volumes && !common_interrupted(); v++) {
            double volume =
                1e-5 * riddle_exp(riddle_log(1999.0) * v / (volumes - 1.0)) * pair.radius * pair.radius * pair.radius;
            double gap[SAMPLES], force[SAMPLES], c[ORDERS][ORDERS + 2];
            sample s = {{0}, 0.0, 0.0, def.angle_i, def.angle_j, bridge_effective_angle(def.angle_i, def.angle_j)};
            bridge_shape shape, last;
            if (bridge_form(&pair, def.radius_i, def.radius_j, volume, 0.0, 0, &s.b) != BRIDGE_OK) continue;
            if (bridge_young_laplace_rupture(&def, volume, &last, NULL) != BRIDGE_OK) continue;
            for (int k = 0; k < SAMPLES; k++) {
                gap[k] = last.gap * (0.5 - 0.5 * cos(RIDDLE_PI * (k + 0.5) / SAMPLES));
                if (bridge_young_laplace(&def, volume, gap[k], &shape) != BRIDGE_OK) return;
                force[k] = shape.force;
            }
            double a = bridge_neck_area(volume, pair.radius);
            for (int n = 0; n < ORDERS; n++) fit_series(n + 2, gap, force, SAMPLES, last.gap, a, c[n]);
            for (int k = 0; k < CHECKS; k++) {
                s.gap = 0.9 * last.gap * k / (CHECKS - 1.0);
                if (bridge_young_laplace(&def, volume, s.gap, &shape) != BRIDGE_OK) return;
                for (int l = 0; l < LAWS; l++)
                    if (bridge_neck_area(volume, pair.radius) > 0.0 && isfinite(laws[l].force(&s)))
                        note(&of_law[l], laws[l].force(&s), shape.force);
                for (int n = 0; n < ORDERS; n++)
                    note(&of_series[n], series_force(c[n], n + 2, last.gap, a, s.gap), shape.force);
            }
            progress_add(bar, 1.0);
        }
    }
}

static void fill_samples(uint64_t seed) {
    bridge_pair pairs[KINDS];
    uint64_t state = seed;
    for (int kind = 0; kind < KINDS; kind++) {
        bridge_pair_def def = kind_def(kind);
        bridge_pair_prepare(&pairs[kind], &def);
    }
    for (int k = 0; k < BRIDGES; k++) {
        double u[4];
        for (int j = 0; j < 4; j++) u[j] = random_plain(&state);
        const bridge_pair *pair = &pairs[(int)(u[0] * KINDS)];
        double volume = 6e-5 * riddle_exp(riddle_log(300.0) * u[1]) * pair->radius * pair->radius * pair->radius;
        sample *s = &samples[k];
        bridge_form(pair, pair->def.radius_i, pair->def.radius_j, volume, 0.0, 0, &s->b);
        s->gap = 0.999 * u[2] * s->b.rupture_gap;
        s->velocity = u[3] - 0.5;
        s->angle_i = pair->def.angle_i;
        s->angle_j = pair->def.angle_j;
        s->mean_angle = bridge_effective_angle(s->angle_i, s->angle_j);
    }
}

#define TIME_SERIES(n)                                                                                                 \
    TIME(series_ns[(n)-2], passes,                                                                                     \
         series_force(coefficients[k & 63], (n), samples[k].b.rupture_gap, samples[k].b.width *samples[k].b.width,     \
                      samples[k].gap))

static void tell_laws(const program *self, json *report, const accuracy *of_law, const accuracy *of_series,
                      int passes) {
    static const result_column columns[] = {{"law", "law", "%s"},
                                            {"evaluation_ns|ns", "ns", "%.1f"},
                                            {"rms_error", "rms error [%]", "%.3g", 100.0},
                                            {"largest_error", "largest [%]", "%.3g", 100.0}};
    static double coefficients[64][ORDERS + 2];
    double series_ns[ORDERS];
    char name[60];
    result_table *r = RESULTS(columns);
    fill_samples(self->seed);
    for (int k = 0; k < 64; k++)
        for (int j = 0; j < ORDERS + 2; j++) coefficients[k][j] = 1.0 / (1.0 + k + j);
    TIME_SERIES(2);
    TIME_SERIES(3);
    TIME_SERIES(4);
    TIME_SERIES(5);
    TIME_SERIES(6);
    TIME_SERIES(7);
    TIME_SERIES(8);
    TIME_SERIES(9);
    for (int l = 0; l < LAWS; l++) {
        double (*force)(const sample *) = laws[l].force, ns;
        TIME(ns, passes, force(&samples[k]));
        results_row(r, TEXTS(laws[l].name), ns, sqrt(of_law[l].square / (double)of_law[l].n), of_law[l].worst);
    }
    for (int n = 0; n < ORDERS; n++) {
        snprintf(name, sizeof name, "series of %d terms", n + 2);
        results_row(r, TEXTS(name), series_ns[n], sqrt(of_series[n].square / (double)of_series[n].n),
                    of_series[n].worst);
    }
    results_write(r, report, "laws", self->out, "laws.csv");

    const double *ns = results_column(r, "ns", 1.0), *percent = results_column(r, "largest_error", 100.0);
    riddle_plot *figure =
        riddle_plot_new("Capillary force, equations of Elskamp & Kruggel-Emden (2019): error against time", 1, 1);
    riddle_plot_panel(figure, 0, 0, "time of one evaluation [ns]", "largest error, gaps to 0.9 of rupture [%]");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    riddle_plot_line(figure, "series of 2 to 9 terms", ns + LAWS, percent + LAWS, ORDERS);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    for (int l = LAWS - 1; l >= 0; l--) riddle_plot_points(figure, laws[l].name, &ns[l], &percent[l], 1);
    riddle_plot_legend_outside(figure);
    riddle_plot_write(figure, self->out, "laws.svg");
    results_free(r);
}

/* ---- 2: everything else ---- */

static double prepare_s(int kind, int repeats) {
    const bridge_pair_def def = kind_def(kind);
    bridge_pair pair;
    const double start = machine_processor_seconds();
    for (int k = 0; k < repeats; k++) bridge_pair_prepare(&pair, &def);
    return (machine_processor_seconds() - start) / repeats;
}

static double allocate_s(int passes) {
    static double film[2 * BRIDGES], scratch[2 * BRIDGES];
    static bridge_contact contacts[BRIDGES];
    for (int k = 0; k < BRIDGES; k++) {
        bridge_contact c = {(size_t)k, (size_t)(k + BRIDGES / 2), BRIDGE_SPHERE, 2.5e-3, 2.5e-3, 0.0, 1.0, 0.0, 0.0};
        contacts[k] = c;
    }
    bridge_films films = {film, 2 * BRIDGES, NULL, NULL, 0, scratch, bridge_quantum(1e-4), 0.0, 0.0};
    double least = HUGE_VAL;
    for (int pass = 0; pass < passes; pass++) {
        for (int k = 0; k < 2 * BRIDGES; k++) film[k] = bridge_quantised(1e-9, films.quantum);
        const double start = machine_seconds();
        bridge_allocate(&films, contacts, BRIDGES);
        least = fmin(least, machine_seconds() - start);
    }
    return least / BRIDGES;
}

static void tell_costs(json *report, int passes, int repeats) {
    const bridge_liquid liquid = bridge_pair_default_def().liquid;
    const bridge_pair_def plate = kind_def(2);
    bridge_pair pair;
    bridge made;
    bridge_shape shape;
    double all, capillary, rupture, form, printed;
    bridge_pair_prepare(&pair, &plate);
    TIME(capillary, passes, bridge_attraction(&samples[k].b, samples[k].gap));
    TIME(all, passes,
         bridge_evaluate(&samples[k].b, &liquid, samples[k].gap, samples[k].velocity).normal +
             bridge_evaluate(&samples[k].b, &liquid, samples[k].gap, samples[k].velocity).tangential);
    TIME(rupture, passes, bridge_is_ruptured(&samples[k].b, &liquid, samples[k].gap, samples[k].velocity));
    TIME(form, passes / 10,
         (bridge_form(&pair, 2.5e-3, (double)INFINITY, samples[k].velocity * 1e-10 + 1e-10, 0.0, 0, &made),
          made.series[3]));
    TIME(printed, passes / 10,
         bridge_evaluate_printed(&pair, &samples[k].b, samples[k].gap, samples[k].velocity).normal);
    const double start = machine_processor_seconds();
    for (int k = 0; k < 10 * repeats; k++) bridge_young_laplace(&plate, 1e-10, 3e-5 * (k % 10), &shape);
    const double solve_s = (machine_processor_seconds() - start) / (10 * repeats);
    results_values(report, {"capillary_s", 1e-9 * capillary, "capillary force", "%.1f ns", 1e9},
                   {"evaluate_s", 1e-9 * all, "all forces (bridge_evaluate)", "%.1f ns", 1e9},
                   {"evaluate_printed_s", 1e-9 * printed, "all forces as printed", "%.1f ns", 1e9},
                   {"rupture_test_s", 1e-9 * rupture, "rupture test", "%.1f ns", 1e9},
                   {"form_s", 1e-9 * form, "form a bridge", "%.1f ns", 1e9},
                   {"allocate_s", allocate_s(passes / 10), "allocate liquid to a contact", "%.1f ns", 1e9},
                   {"young_laplace_s", solve_s, "Young-Laplace, one bridge", "%.1f us", 1e6},
                   {"prepare_s", prepare_s(0, repeats), "prepare a kind, equal spheres", "%.2f ms", 1e3},
                   {"prepare_plate_s", prepare_s(2, repeats), "prepare a kind, plate", "%.2f ms", 1e3});
}

/* ---- 3: the pairs ---- */

static void tell_pairs(void) {
    static const result_column columns[] = {{NULL, "kind of pair", "%s"},
                                            {NULL, "force off [%]", "%.3f", 100.0},
                                            {NULL, "rupture gap off [%]", "%.4f", 100.0}};
    result_table *r = RESULTS(columns);
    for (int kind = 0; kind < KINDS; kind++) {
        const bridge_pair_def def = kind_def(kind);
        bridge_pair pair;
        bridge_pair_prepare(&pair, &def);
        results_row(r, TEXTS(kind_names[kind]), pair.deviation, pair.rupture_deviation);
    }
    results_print(r);
    results_free(r);
}

int main(int argc, char **argv) {
    program self =
        program_start("bench_liquid_bridge",
                      "Capillary force: error against Young-Laplace versus time; cost of everything a bridge needs.",
                      NULL, 0, argc, argv);
    const int volumes = self.quick ? 6 : 24, passes = self.quick ? 20 : 200;
    accuracy of_law[LAWS] = {{0.0, 0.0, 0}}, of_series[ORDERS] = {{0.0, 0.0, 0}};
    progress bar;
    progress_begin(&bar, "solving", (double)(KINDS * volumes));
    measure_errors(volumes, of_law, of_series, &bar);
    progress_end(&bar);
    if (common_interrupted()) return common_exit_status();
    json *report = json_open(self.json);
    tell_laws(&self, report, of_law, of_series, passes);
    tell_costs(report, passes, self.quick ? 3 : 20);
    tell_pairs();
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
