/* Planning a batch on a wet screen: screen_models.h says how fast undersize passes, blocking.h how many holes are left for it.

   Choose amplitude, frequency, moisture, deck area and feed; get the time to a wanted recovery of the undersize, with its uncertainty,
   with blocking and without, by the models of Dong, Subasinghe and Soldinger with the parameters of Elskamp & Kruggel-Emden (2019).
   Their 27 cases are glass spheres of 5 and 7 mm (and 10 mm that stay) on an 8 mm mesh, A 0.8-1.2 mm, f 45.8-55.4 Hz, moisture 0-0.05:
   the defaults; beyond, they extrapolate.

   How the two are composed: each model's rate of passing is multiplied by the free holes per mass of feed over those of the study: by
   the free fraction f(t), mean over each small step, and by (area / feed) / (0.02835 m2 / 1.41 kg) (eq 17 of Lawinska et al. 2016: what
   counts is f F A0). That is k_p of Subasinghe and Soldinger and k of Dong, its trials per time. Stratification is not slowed by
   blocking.

   k1 and k2 are yours: count holes and use sieve_blocking --data, or simulate. Without --k1 and --k2 the rate constants of Table 2, fit
   7b, of Lawinska et al. stand in as an illustration; they are dry spheres on a 1 mm mesh. Table 3 of that paper (mean free fraction
   from K and x_h, --xh) is used only inside the box it was measured in; all 27 cases lie outside.

   Uncertainty: the published deviation of each model (mean |Y - Y_dem| 0.0593, 0.0387, 0.0417, as a normal error of the recovery) and
   the relative errors of k1 and k2 (--rate-error), 95 % ranges.

   Writes retained.svg (curves), map.svg (amplitude and frequency), area.svg, and their CSV files. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "blocking.h"
#include "common.h"
#include "screen_models.h"

enum { MODELS = 3, CLASSES = 8, SAMPLES = 1000, MAP = 25, AREAS = 25, MOST_STEPS = 4000 };

static const double pi = 3.14159265358979323846;
static const double deviation[MODELS] = {0.0593, 0.0387, 0.0417}; /* Elskamp & Kruggel-Emden (2019), section 5.3, one set for all cases */
static const double study_area = 0.02835, study_feed = 1.41;      /* [m2] [kg], what the published parameters hold for */
static const char *const model_names[MODELS] = {"Dong", "Subasinghe", "Soldinger"};

/* The holes: a curve of f in time, or a constant f (k = 0). */
typedef struct holes {
    double f0, f_inf, k;
} holes;
static const holes clean = {1.0, 1.0, 0.0};

typedef struct plan {
    screen_def def;
    screen_operation operation;
    double diameters[CLASSES];
    double recovery, limit, step; /* [-] [s] [s] */
} plan;

static screen_model model_of(int index) { return (screen_model)(SCREEN_DONG + index); }

/* Holes per mass of feed over those of the study, all free */
static double free_holes(const plan *p) {
    return p->def.deck_area / (p->def.undersize_mass + p->def.oversize_mass) * (study_feed / study_area);
}

/* Steps through the batch until the wanted recovery of all undersize, or the limit. Returns the time [s], infinite if it is not
   reached; curve (may be NULL) takes [MOST_STEPS][1 + CLASSES] time and retained by class, *rows their number, and the run then goes on
   to the limit. */
static double run(const plan *p, int model, const holes *h, double wanted, double *curve, int *rows) {
    screen_bed bed[CLASSES];
    double published[SCREEN_MAX_PARAMETERS], now[SCREEN_MAX_PARAMETERS], reached = HUGE_VAL, before = 0.0;
    int passage = model == 0 ? 0 : 3; /* k of model 1, k_p of models 2 and 3 */
    if (screen_published(model_of(model), published) != SCREEN_OK || screen_bed_init(&p->def, model_of(model), bed) != SCREEN_OK)
        return (double)NAN;
    memcpy(now, published, sizeof now);
    if (!(wanted > 0.0)) reached = 0.0;
    int last = (int)ceil(p->limit / p->step - 1e-9);
    for (int i = 0; i <= last && i < MOST_STEPS; i++) {
        double t = i * p->step, fed = 0.0, passed = 0.0;
        if (i > 0) { /* f over the step is the mean of a curve that starts where this one is */
            double f = blocking_curve(h->f0, h->f_inf, h->k, t - p->step);
            now[passage] = published[passage] * free_holes(p) * fmax(blocking_time_mean(f, h->f_inf, h->k, p->step), 1e-9);
            if (screen_step(&p->def, model_of(model), now, &p->operation, p->step, NULL, bed, NULL) != SCREEN_OK) return (double)NAN;
        }
        for (int c = 0; c < p->def.classes; c++) {
            fed += bed[c].fed;
            passed += bed[c].passed;
            if (curve) curve[i * (1 + CLASSES) + 1 + c] = 1.0 - bed[c].passed / bed[c].fed;
        }
        if (curve) {
            curve[i * (1 + CLASSES)] = t;
            *rows = i + 1;
        }
        double recovery = passed / fed;
        if (recovery >= wanted && !(reached < HUGE_VAL)) {
            reached = i == 0 ? 0.0 : t - p->step * (recovery - wanted) / (recovery - before);
            if (!curve) break;
        }
        before = recovery;
    }
    return reached;
}

/* ---- uncertainty ---- */

static double next_random(uint64_t *s) { /* 0 < u < 1, splitmix64 */
    uint64_t x = *s += 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return ((double)((x ^ x >> 31) >> 11) + 0.5) * 0x1p-53;
}
static double normal(uint64_t *s) { return sqrt(-2.0 * log(next_random(s))) * cos(2.0 * pi * next_random(s)); }

static int ascending(const void *a, const void *b) {
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

typedef struct answer {
    double time, low, high; /* [s]; infinite: not within the limit */
} answer;

/* The time and its 95 % range. rate_error: relative standard error of k1 and k2. */
static answer ask(const plan *p, int model, const holes *h, double rate_error, int samples, uint64_t seed) {
    double times[SAMPLES], k1 = blocking_k1(h->f_inf, h->k), k2 = blocking_k2(h->f_inf, h->k);
    uint64_t error_seed = seed + 1; /* errors of their own, the same for every set of holes */
    answer a;
    a.time = run(p, model, h, p->recovery, NULL, NULL);
    for (int i = 0; i < samples; i++) {
        holes drawn = *h;
        if (h->k > 0.0) {
            double r1 = k1 * exp(rate_error * normal(&seed)), r2 = k2 * exp(rate_error * normal(&seed));
            drawn.k = r1 + r2;
            drawn.f_inf = blocking_equilibrium(r1, r2);
        }
        /* a normal error whose mean size is the deviation has the spread deviation sqrt(pi/2) */
        double error = deviation[model] * sqrt(0.5 * pi) * normal(&error_seed), wanted = p->recovery + error;
        times[i] = wanted < 1.0 ? run(p, model, &drawn, wanted, NULL, NULL) : HUGE_VAL;
    }
    qsort(times, (size_t)samples, sizeof(double), ascending);
    a.low = times[(int)(0.025 * samples)];
    a.high = times[(int)(0.975 * samples)];
    return a;
}

static const char *seconds(char *text, double t, double limit) {
    if (t < HUGE_VAL) snprintf(text, 32, "%.2f", t);
    else snprintf(text, 32, "> %g", limit);
    return text;
}

static void report_answer(json *report, const char *key, const answer *a) {
    json_object_begin(report, key);
    json_number(report, "time_s", a->time);
    json_number(report, "low_s", a->low);
    json_number(report, "high_s", a->high);
    json_object_end(report);
}

/* ---- figures ---- */

/* A cell of a CSV file: empty for what is not reached. */
static const char *cell(char *text, double x) {
    text[0] = '\0';
    if (x < HUGE_VAL) snprintf(text, 32, "%.17g", x);
    return text;
}

static void draw_retained(const program *self, const plan *p, const holes *h) {
    static double curve[2][MOST_STEPS * (1 + CLASSES)], x[MOST_STEPS], y[2][MOST_STEPS], low[MOST_STEPS], high[MOST_STEPS];
    plan q = *p;
    q.step = 0.1;
    plot *figure = plot_new("Undersize still on the deck, clean and blocking", 1, MODELS);
    csv *file = csv_open(self->out, "retained.csv", "model,time_s,retained_clean,retained_blocking");
    for (int m = 0; m < MODELS; m++) {
        int rows = 0;
        for (int b = 0; b < 2; b++) run(&q, m, b ? h : &clean, p->recovery, curve[b], &rows);
        for (int i = 0; i < rows; i++) {
            x[i] = curve[0][i * (1 + CLASSES)];
            for (int b = 0; b < 2; b++) {
                y[b][i] = 0.0; /* equal shares of all classes */
                for (int c = 0; c < p->def.classes; c++) y[b][i] += curve[b][i * (1 + CLASSES) + 1 + c] / p->def.classes;
            }
            low[i] = fmax(y[1][i] - 1.96 * sqrt(0.5 * pi) * deviation[m], 0.0);
            high[i] = fmin(y[1][i] + 1.96 * sqrt(0.5 * pi) * deviation[m], 1.0);
            csv_line(file, "%s,%.17g,%.17g,%.17g", model_names[m], x[i], y[0][i], y[1][i]);
        }
        plot_panel(figure, 0, m, "time [s]", m ? "" : "undersize retained [-]");
        plot_title(figure, model_names[m]);
        plot_range_y(figure, 0.0, 1.0);
        plot_band(figure, "95 % band", x, low, high, rows);
        plot_style(figure, PLOT_FAINT, 1);
        plot_line(figure, "holes clean", x, y[0], rows);
        plot_style(figure, PLOT_DASHED, 0);
        plot_line(figure, "holes blocking", x, y[1], rows);
        plot_style(figure, 0, 1);
        plot_horizontal(figure, "wanted", 1.0 - p->recovery);
    }
    csv_close(file);
    plot_write(figure, self->out, "retained.svg");
}

static void draw_map(const program *self, const plan *p, int model, const holes *h) {
    static double time[2][MAP * MAP];
    plan q = *p;
    double lowest = HUGE_VAL, highest = 0.0;
    q.step = fmax(p->step, 0.05);
    csv *file = csv_open(self->out, "map.csv", "amplitude_m,frequency_hz,toss_indicator,time_clean_s,time_blocking_s");
    progress bar;
    progress_begin(&bar, "map of amplitude and frequency", MAP);
    for (int j = 0; j < MAP && !common_interrupted(); j++) {
        for (int i = 0; i < MAP; i++) {
            q.operation.amplitude = 1e-3 * (0.7 + 0.6 * i / (MAP - 1));
            q.operation.frequency = 43.0 + 15.0 * j / (MAP - 1);
            for (int b = 0; b < 2; b++) {
                double t = run(&q, model, b ? h : &clean, p->recovery, NULL, NULL);
                time[b][j * MAP + i] = t < HUGE_VAL ? t : (double)NAN;
                if (t < HUGE_VAL) {
                    lowest = fmin(lowest, t);
                    highest = fmax(highest, t);
                }
            }
            double K = blocking_toss_indicator(q.operation.frequency, q.operation.amplitude, 0.5 * pi, 0.0, q.def.gravity);
            double line[5] = {q.operation.amplitude, q.operation.frequency, K, time[0][j * MAP + i], time[1][j * MAP + i]};
            csv_row(file, line, 5);
        }
        progress_update(&bar, j + 1.0);
    }
    progress_end(&bar);
    csv_close(file);
    char title[160];
    snprintf(title, sizeof title, "Time to %.3g %% of the undersize, model of %s, moisture %.3g %%", 100.0 * p->recovery,
             model_names[model], 100.0 * p->operation.moisture);
    plot *figure = plot_new(title, 1, 2);
    for (int b = 0; b < 2; b++) {
        double A = 1e3 * p->operation.amplitude, f = p->operation.frequency;
        plot_panel(figure, 0, b, "amplitude [mm]", "frequency [Hz]");
        plot_title(figure, b ? "holes blocking" : "holes clean");
        plot_heat(figure, "time [s]", time[b], MAP, MAP, 0.7, 1.3, 43.0, 58.0);
        if (lowest < highest) plot_heat_range(figure, lowest, highest);
        if (A >= 0.7 && A <= 1.3 && f >= 43.0 && f <= 58.0) plot_points(figure, "chosen", &A, &f, 1);
    }
    plot_write(figure, self->out, "map.svg");
}

static void draw_area(const program *self, const plan *p, const holes *h) {
    double area[AREAS], time[2][AREAS];
    plan q = *p;
    csv *file = csv_open(self->out, "area.csv", "model,deck_area_m2,load_kg_m2,time_clean_s,time_blocking_s");
    plot *figure = plot_new("Deck area for the same feed", 1, 1);
    plot_panel_size(figure, 560, 360);
    plot_panel(figure, 0, 0, "deck area [m²]", "time to the wanted recovery [s]");
    plot_log_x(figure);
    plot_log_y(figure);
    q.step = fmax(p->step, 0.05);
    for (int m = 0; m < MODELS && !common_interrupted(); m++) {
        for (int i = 0; i < AREAS; i++) {
            area[i] = q.def.deck_area = p->def.deck_area * pow(4.0, 2.0 * i / (AREAS - 1) - 1.0);
            for (int b = 0; b < 2; b++) time[b][i] = run(&q, m, b ? h : &clean, p->recovery, NULL, NULL);
            char a[32], b[32];
            csv_line(file, "%s,%.17g,%.17g,%s,%s", model_names[m], area[i], (p->def.undersize_mass + p->def.oversize_mass) / area[i],
                     cell(a, time[0][i]), cell(b, time[1][i]));
        }
        char label[60];
        snprintf(label, sizeof label, "%s, blocking", model_names[m]);
        plot_line(figure, label, area, time[1], AREAS);
        plot_style(figure, 0, m);
        snprintf(label, sizeof label, "%s, clean", model_names[m]);
        plot_line(figure, label, area, time[0], AREAS);
        plot_style(figure, PLOT_DASHED, m);
    }
    csv_close(file);
    plot_vertical(figure, "chosen", p->def.deck_area);
    plot_legend_outside(figure);
    plot_write(figure, self->out, "area.svg");
}

/* ---- options ---- */

static int read_diameters(const char *text, double *diameters) {
    int n = 0;
    for (char *end; *text && n < CLASSES; text = *end == ',' ? end + 1 : end) {
        diameters[n++] = 1e-3 * strtod(text, &end);
        if (end == text || (*end && *end != ',')) return 0;
    }
    return *text ? 0 : n;
}

int main(int argc, char **argv) {
    const char *classes = "5,7";
    double A = 1.0, frequency = 50.6, moisture = 0.025, area = 0.02835, feed = 1.41, share = 2.0 / 3.0, coarse = 10.0, opening = 8.0,
           wire = 2.0;
    double recovery = 0.9, limit = 40.0, k1 = blocking_k1(.714, .0101), k2 = blocking_k2(.714, .0101), f0 = 1.0, rate_error = 0.3,
           x_h = 0.5;
    int chosen = 2, shape = 0;
    option options[] = {
        option_positive("amplitude-mm", "A", &A, 10.0, "amplitude of the deck [mm]"),
        option_positive("frequency-hz", "F", &frequency, 1000.0, "frequency of the deck [Hz]"),
        option_double("moisture", "M", &moisture, 0.0, 0.2, "mass of liquid over mass of grains [-], a fraction"),
        option_positive("area-m2", "F", &area, 1000.0, "area of the deck [m2]"),
        option_positive("feed-kg", "M", &feed, 1e6, "mass of the batch [kg]"),
        option_double("undersize", "X", &share, 1e-3, 1.0, "share of the feed that can pass [-]"),
        option_string("diameters-mm", "D,D..", &classes, "undersize classes of equal mass, at most 8 [mm]"),
        option_positive("coarse-mm", "D", &coarse, 1000.0, "size of what stays [mm]"),
        option_positive("opening-mm", "L", &opening, 1000.0, "size of the holes [mm]"),
        option_double("wire-mm", "W", &wire, 0.0, 1000.0, "diameter of the wires [mm]"),
        option_double("recovery", "R", &recovery, 0.01, 0.9999, "wanted share of the undersize that has passed [-]"),
        option_double("limit-s", "T", &limit, 1.0, 60.0, "longest batch looked at [s]"),
        option_choice("model", &chosen, "dong|subasinghe|soldinger", "model of the map"),
        option_double("k1", "K1", &k1, 0.0, 1e3, "rate constant of blocking [1/s]; default: Table 2, fit 7b"),
        option_double("k2", "K2", &k2, 0.0, 1e3, "rate constant of unblocking [1/s]; default: Table 2, fit 7b"),
        option_double("f0", "F0", &f0, 0.0, 1.0, "free fraction of the holes at the start [-]; 0.949 without --k1 and --k2"),
        option_double("rate-error", "S", &rate_error, 0.0, 2.0, "relative standard error of k1 and k2 [-]"),
        option_double("xh", "X", &x_h, 0.0, 1.0, "hard-to-screen content of the feed [-], for Table 3"),
        option_choice("shape", &shape, "spherical|irregular|sharp|sharp-repaired", "grains, for Table 3"),
    };
    program self =
        program_start("wet_screen_designer", "Time to a wanted recovery on a wet screen, with blocking and without, and its uncertainty.",
                      options, (int)(sizeof options / sizeof *options), argc, argv);
    plan p;
    p.def = screen_default_def();
    p.def.classes = read_diameters(classes, p.diameters);
    if (p.def.classes == 0) program_refuse(&self, "diameters-mm", classes, "up to 8 numbers and commas, as 5,7");
    p.def.diameters = p.diameters;
    p.def.aperture = 1e-3 * opening;
    p.def.wire = 1e-3 * wire;
    p.def.deck_area = area;
    p.def.undersize_mass = feed * share;
    p.def.oversize_mass = feed * (1.0 - share);
    p.def.coarse_diameter = 1e-3 * coarse;
    p.operation.amplitude = 1e-3 * A;
    p.operation.frequency = frequency;
    p.operation.moisture = moisture;
    p.operation.inclination = 0.0;
    p.recovery = recovery;
    p.limit = limit;
    p.step = 0.02;
    const char *field = NULL;
    if (screen_check_def(&p.def, &field) != SCREEN_OK)
        program_refuse(&self, strcmp(field, "diameters") == 0 ? "diameters-mm" : "opening-mm",
                       strcmp(field, "diameters") == 0 ? classes : NULL, "grain sizes above 0 and below the opening");
    if (options[13].given != options[14].given)
        program_refuse(&self, options[13].given ? "k1" : "k2", NULL, "both --k1 and --k2, or neither");
    const bool own = options[13].given;
    if (!own && !options[15].given) f0 = .949; /* goes with the default k1 and k2 */
    holes h;
    h.f0 = f0;
    h.k = k1 + k2;
    h.f_inf = h.k > 0.0 ? blocking_equilibrium(k1, k2) : f0;

    blocking_conditions conditions = blocking_default_conditions();
    conditions.K = blocking_toss_indicator(frequency, 1e-3 * A, 0.5 * pi, 0.0, p.def.gravity);
    conditions.x_h = x_h;
    conditions.opening = 1e-3 * opening;
    conditions.grain_min = conditions.grain_max = 1e-3 * coarse;
    for (int c = 0; c < p.def.classes; c++) conditions.grain_min = fmin(conditions.grain_min, p.diameters[c]);
    conditions.moisture = moisture;
    blocking_average average;
    blocking_average_free((blocking_shape)shape, &conditions, &average);
    const bool offered = !(average.flags & BLOCKING_FLAG_BOX);
    holes table3 = {average.value, average.value, 0.0};

    common_print("K %.2f: %s\n", conditions.K, blocking_toss_text(blocking_toss_range(conditions.K)));
    common_print("Load %.1f kg/m2; clearance A0 %.3f, effective area in the long run %.4f m2 of %.4f m2 of holes\n", feed / area,
                 blocking_open_area(opening, wire), blocking_effective_area(h.f_inf, area, blocking_open_area(opening, wire)),
                 area * blocking_open_area(opening, wire));
    common_print("Blocking: f0 %.3f, f_inf %.3f, k1 %.4f 1/s, k2 %.4f 1/s%s\n", h.f0, h.f_inf, k1, k2,
                 own ? "" : ", an illustration (Table 2, fit 7b: dry, 1 mm): give --k1 and --k2");
    if (A < 0.8 || A > 1.2 || frequency < 45.8 || frequency > 55.4 || moisture > 0.05 || opening != 8.0)
        common_print("Outside the 27 cases (A 0.8-1.2 mm, f 45.8-55.4 Hz, moisture 0-0.05, 8 mm): the models extrapolate\n");
    if (fabs(free_holes(&p) - 1.0) > 0.01)
        common_print("Load: the models were fitted at %.1f kg/m2; passing is taken %.2f times as fast\n", study_feed / study_area,
                     free_holes(&p));
    common_print("Table 3 %s", offered ? "applies: mean free fraction" : "is not offered:");
    if (offered) common_print(" %.3f\n\n", average.value);
    else {
        const char *separator = "";
        for (unsigned flag = 1; flag < BLOCKING_FLAG_BOX; flag *= 2) {
            if (!(average.flags & flag)) continue;
            common_print("%s %s", separator, blocking_flag_text(flag));
            separator = ";";
        }
        common_print("\n\n");
    }

    json *report = json_open(self.json);
    json_number(report, "recovery", recovery);
    json_number(report, "toss_indicator", conditions.K);
    json_number(report, "load_kg_per_m2", feed / area);
    json_number(report, "f0", h.f0);
    json_number(report, "f_inf", h.f_inf);
    json_number(report, "k1_per_s", k1);
    json_number(report, "k2_per_s", k2);
    json_bool(report, "rates_are_yours", own);
    json_bool(report, "table3_offered", offered);
    json_number(report, "table3_mean_free", offered ? average.value : (double)NAN);
    table t = table_begin(offered ? "model|clean holes [s]|95 % range|blocking [s]|95 % range|Table 3 [s]|95 % range"
                                  : "model|clean holes [s]|95 % range|blocking [s]|95 % range");
    const int samples = self.quick ? 200 : SAMPLES;
    for (int m = 0; m < MODELS && !common_interrupted(); m++) {
        const holes *cases[3] = {&clean, &h, &table3};
        const char *const keys[3] = {"clean", "blocking", "table3"};
        plan q = p;
        q.step = 0.05;
        json_object_begin(report, model_names[m]);
        table_cell(&t, "%s", model_names[m]);
        for (int c = 0; c < (offered ? 3 : 2); c++) {
            char a[32], b[32];
            answer got = ask(&q, m, cases[c], rate_error, samples, self.seed);
            got.time = run(&p, m, cases[c], recovery, NULL, NULL);
            if (isnan(got.time)) common_fail("the model of %s has no answer for these numbers", model_names[m]);
            table_cell(&t, "%s", seconds(a, got.time, limit));
            table_cell(&t, "%s .. %s", seconds(a, got.low, limit), seconds(b, got.high, limit));
            report_answer(report, keys[c], &got);
        }
        json_object_end(report);
    }
    common_print("Time to %.4g %% of the undersize:\n", 100.0 * recovery);
    table_end(&t);
    draw_retained(&self, &p, &h);
    draw_map(&self, &p, chosen, &h);
    draw_area(&self, &p, &h);
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
