/* Planning a batch on a wet screen: screen_models.h gives the rate of passage, blocking.h the free holes.

   Choose amplitude, frequency, moisture, deck area and feed; get the time to a wanted recovery of the undersize, with
   its uncertainty, with blocking and without, by the models of Dong, Subasinghe and Soldinger with the parameters of
   Elskamp & Kruggel-Emden (2019). Their 27 cases are glass spheres of 5 and 7 mm (and 10 mm that stay) on an 8 mm mesh,
   A 0.8-1.2 mm, f 45.8-55.4 Hz, moisture 0-0.05: the defaults; beyond these ranges the models extrapolate.

   Each model's rate of passage (k_p of Subasinghe and Soldinger, k of Dong: its trials in a time) is multiplied by the
   free holes per mass of feed over those of the study: by the free fraction f(t), mean over each small step, and by
   (area / feed) / (0.02835 m2 / 1.41 kg) (eq 17 of Lawinska et al. 2016: f F A0). Blocking does not slow
   stratification.

   You give k1 and k2: count holes and use sieve_blocking --data, or simulate. Without --k1 and --k2 the rate constants
   of Table 2, fit 7b, of Lawinska et al. are used as an illustration; they are for dry spheres on a 1 mm mesh. Table 3
   of that paper (mean free fraction from K and x_h, --xh) is used only inside the box it was measured in; all 27 cases
   lie outside.

   Uncertainty: the published deviation of each model (mean |Y - Y_dem| 0.0593, 0.0387, 0.0417, as a normal error of the
   recovery) and the relative errors of k1 and k2 (--rate-error), 95 % ranges.

   Your own screen: --parameters FILE, the parameters.json of screen_fit --data, predicts by all models fitted there,
   for classes from --diameters-mm, a sieve curve (--psd), --rosin-rammler or --lognormal. Ranges include the errors of
   the parameters, of the model on whole cases, and of k1 and k2. The program names what lies outside the range of the
   fit. With --feed-kg-s the deck is fed continuously: efficiency, flows and bed depth, and the largest feed for the
   recovery.

   --tests FILE: k1 and k2 from counts of many blocking tests, by a fitted law, with its errors (as sieve_blocking
   --tests).

   Writes retained.svg (curves), map.svg (amplitude and frequency), area.svg, and their CSV files. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "blocking.h"
#include "sieve_blocking/blocking_tests.h"
#include "common.h"
#include "screen_fit/screen_lab.h"
#include "screen_models.h"

enum { MODELS = 3, CLASSES = 8, SAMPLES = 1000, MAP = 25, AREAS = 25, MOST_STEPS = 4000 };

/* Elskamp & Kruggel-Emden (2019), section 5.3, one set for all cases. */
static const double deviation[MODELS] = {0.0593, 0.0387, 0.0417};
/* [m2] [kg], what the published parameters hold for */
static const double study_area = 0.02835, study_feed = 1.41;
static const char *const model_names[MODELS] = {"Dong", "Subasinghe", "Soldinger"};

/* k1 and k2 with what is known of their errors: a relative one, or the law that they come from. */
typedef struct rates {
    double k1, k2, error;    /* [1/s], [1/s], relative standard error of each [-] */
    const blocking_law *law; /* or NULL */
    double K, x_h, moisture; /* where the law is read */
} rates;

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

/* Steps through the batch until the wanted recovery of all undersize, or the limit. Returns the time [s], infinite if
   it is not reached; curve (may be NULL) takes [MOST_STEPS][1 + CLASSES] time and retained by class, *rows their
   number, and the run then goes on to the limit. */
static double run(const plan *p, int model, const holes *h, double wanted, double *curve, int *rows) {
    screen_bed bed[CLASSES];
    double published[SCREEN_MAX_PARAMETERS], now[SCREEN_MAX_PARAMETERS], reached = HUGE_VAL, before = 0.0;
    int passage = model == 0 ? 0 : 3; /* k of model 1, k_p of models 2 and 3 */
    if (screen_published(model_of(model), published) != SCREEN_OK ||
        screen_bed_init(&p->def, model_of(model), bed) != SCREEN_OK)
        return (double)NAN;
    memcpy(now, published, sizeof now);
    if (!(wanted > 0.0)) reached = 0.0;
    int last = (int)ceil(p->limit / p->step - 1e-9);
    for (int i = 0; i <= last && i < MOST_STEPS; i++) {
        double t = i * p->step, fed = 0.0, passed = 0.0;
        if (i > 0) { /* f over the step is the mean of a curve that starts where this one is */
            double f = blocking_curve(h->f0, h->f_inf, h->k, t - p->step);
            now[passage] =
                published[passage] * free_holes(p) * fmax(blocking_time_mean(f, h->f_inf, h->k, p->step), 1e-9);
            if (screen_step(&p->def, model_of(model), now, &p->operation, p->step, NULL, bed, NULL) != SCREEN_OK)
                return (double)NAN;
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

static double normal(uint64_t *s) { return sqrt(-2.0 * log(random_inner(s))) * cos(2.0 * RIDDLE_PI * random_inner(s)); }

static int ascending(const void *a, const void *b) {
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

typedef struct answer {
    double time, low, high; /* [s]; infinite: not within the limit */
} answer;

/* k1 and k2 as they may be as well. */
static void draw_rates(const rates *r, uint64_t *seed, double *k1, double *k2) {
    const double z1 = normal(seed), z2 = normal(seed);
    if (r->law && blocking_law_draw(r->law, r->K, r->x_h, r->moisture, z1, z2, k1, k2) == BLOCKING_OK) return;
    *k1 = r->k1 * exp(r->error * z1);
    *k2 = r->k2 * exp(r->error * z2);
}

/* The time and its 95 % range, the holes' rates being drawn where they block. */
static answer ask(const plan *p, int model, const holes *h, const rates *r, int samples, uint64_t seed) {
    double times[SAMPLES];
    uint64_t error_seed = seed + 1; /* errors of their own, the same for every set of holes */
    answer a;
    a.time = run(p, model, h, p->recovery, NULL, NULL);
    for (int i = 0; i < samples; i++) {
        holes drawn = *h;
        if (h->k > 0.0) {
            double k1, k2;
            draw_rates(r, &seed, &k1, &k2);
            drawn.k = k1 + k2;
            drawn.f_inf = blocking_equilibrium(k1, k2);
        }
        /* a normal error whose mean size is the deviation has the spread deviation sqrt(pi/2) */
        double error = deviation[model] * sqrt(0.5 * RIDDLE_PI) * normal(&error_seed), wanted = p->recovery + error;
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
    results_values(report, {"time_s", a->time}, {"low_s", a->low}, {"high_s", a->high});
    json_object_end(report);
}

/* ---- figures ---- */

static void draw_retained(const program *self, const plan *p, const holes *h, bool extrapolated) {
    static double curve[2][MOST_STEPS * (1 + CLASSES)], x[MOST_STEPS], y[2][MOST_STEPS], low[MOST_STEPS],
        high[MOST_STEPS];
    plan q = *p;
    q.step = 0.1;
    riddle_plot *figure = riddle_plot_new("Undersize still on the deck, clean and blocking", 1, MODELS);
    riddle_io_file *file = csv_open(self->out, "retained.csv", "model,time_s,retained_clean,retained_blocking");
    for (int m = 0; m < MODELS; m++) {
        int rows = 0;
        for (int b = 0; b < 2; b++) run(&q, m, b ? h : &clean, p->recovery, curve[b], &rows);
        for (int i = 0; i < rows; i++) {
            x[i] = curve[0][i * (1 + CLASSES)];
            for (int b = 0; b < 2; b++) {
                y[b][i] = 0.0; /* equal shares of all classes */
                for (int c = 0; c < p->def.classes; c++)
                    y[b][i] += curve[b][i * (1 + CLASSES) + 1 + c] / p->def.classes;
            }
            low[i] = fmax(y[1][i] - 1.96 * sqrt(0.5 * RIDDLE_PI) * deviation[m], 0.0);
            high[i] = fmin(y[1][i] + 1.96 * sqrt(0.5 * RIDDLE_PI) * deviation[m], 1.0);
            csv_line(file, "%s,%.17g,%.17g,%.17g", model_names[m], x[i], y[0][i], y[1][i]);
        }
        riddle_plot_panel(figure, 0, m, "time [s]", m ? "" : "undersize retained [-]");
        char title[60];
        snprintf(title, sizeof title, "%s%s", model_names[m], extrapolated ? ", extrapolated" : "");
        riddle_plot_title(figure, title);
        riddle_plot_range_y(figure, 0.0, 1.0);
        riddle_plot_band(figure, "95 % band", x, low, high, rows);
        riddle_plot_style(figure, RIDDLE_PLOT_FAINT, 1);
        riddle_plot_line(figure, "holes clean", x, y[0], rows);
        riddle_plot_style(figure, RIDDLE_PLOT_DASHED, 0);
        riddle_plot_line(figure, "holes blocking", x, y[1], rows);
        riddle_plot_style(figure, 0, 1);
        riddle_plot_horizontal(figure, "wanted", 1.0 - p->recovery);
    }
    riddle_io_close(file);
    riddle_plot_write(figure, self->out, "retained.svg");
}

static void draw_map(const program *self, const plan *p, int model, const holes *h) {
    static double time[2][MAP * MAP];
    plan q = *p;
    double lowest = HUGE_VAL, highest = 0.0;
    q.step = fmax(p->step, 0.05);
    riddle_io_file *file =
        csv_open(self->out, "map.csv", "amplitude_m,frequency_hz,toss_indicator,time_clean_s,time_blocking_s");
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
            double K = blocking_toss_indicator(q.operation.frequency, q.operation.amplitude, 0.5 * RIDDLE_PI, 0.0,
                                               q.def.gravity);
            double line[5] = {q.operation.amplitude, q.operation.frequency, K, time[0][j * MAP + i],
                              time[1][j * MAP + i]};
            riddle_io_row(file, line, 5);
        }
        progress_update(&bar, j + 1.0);
    }
    progress_end(&bar);
    riddle_io_close(file);
    char title[160];
    snprintf(title, sizeof title, "Time to %.3g %% of the undersize, model of %s, moisture %.3g %%",
             100.0 * p->recovery, model_names[model], 100.0 * p->operation.moisture);
    riddle_plot *figure = riddle_plot_new(title, 1, 2);
    for (int b = 0; b < 2; b++) {
        double A = 1e3 * p->operation.amplitude, f = p->operation.frequency;
        riddle_plot_panel(figure, 0, b, "amplitude [mm]", "frequency [Hz]");
        riddle_plot_title(figure, b ? "holes blocking" : "holes clean");
        riddle_plot_heat(figure, "time [s]", time[b], MAP, MAP, 0.7, 1.3, 43.0, 58.0);
        if (lowest < highest) riddle_plot_heat_range(figure, lowest, highest);
        if (A >= 0.7 && A <= 1.3 && f >= 43.0 && f <= 58.0) riddle_plot_points(figure, "chosen", &A, &f, 1);
    }
    riddle_plot_write(figure, self->out, "map.svg");
}

static void draw_area(const program *self, const plan *p, const holes *h) {
    double area[AREAS], time[2][AREAS];
    plan q = *p;
    static const result_column columns[] = {
        {"model", NULL, "%s"}, {"deck_area_m2"}, {"load_kg_m2"}, {"time_clean_s"}, {"time_blocking_s"}};
    result_table *t = RESULTS(columns);
    riddle_plot *figure = riddle_plot_new("Deck area for the same feed", 1, 1);
    riddle_plot_panel_size(figure, 560, 360);
    riddle_plot_panel(figure, 0, 0, "deck area [m²]", "time to the wanted recovery [s]");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    q.step = fmax(p->step, 0.05);
    for (int m = 0; m < MODELS && !common_interrupted(); m++) {
        for (int i = 0; i < AREAS; i++) {
            area[i] = q.def.deck_area = p->def.deck_area * pow(4.0, 2.0 * i / (AREAS - 1) - 1.0);
            for (int b = 0; b < 2; b++) time[b][i] = run(&q, m, b ? h : &clean, p->recovery, NULL, NULL);
            results_row(t, TEXTS(model_names[m]), area[i], (p->def.undersize_mass + p->def.oversize_mass) / area[i],
                        time[0][i], time[1][i]);
        }
        char label[60];
        snprintf(label, sizeof label, "%s, blocking", model_names[m]);
        riddle_plot_line(figure, label, area, time[1], AREAS);
        riddle_plot_style(figure, 0, m);
        snprintf(label, sizeof label, "%s, clean", model_names[m]);
        riddle_plot_line(figure, label, area, time[0], AREAS);
        riddle_plot_style(figure, RIDDLE_PLOT_DASHED, m);
    }
    results_csv(t, self->out, "area.csv");
    results_free(t);
    riddle_plot_vertical(figure, "chosen", p->def.deck_area);
    riddle_plot_legend_outside(figure);
    riddle_plot_write(figure, self->out, "area.svg");
}

/* ---- a screen of one's own ---- */

enum { OWN_CLASSES = 64, OWN_POINTS = 500, OWN_TIMES = 121, OWN_SETS = 200 };

typedef struct own {
    screen_def def;
    screen_operation operation;
    double diameters[OWN_CLASSES], undersize; /* share of the feed below the aperture */
    double recovery, limit;
    double free_time[OWN_TIMES], free_fraction[OWN_TIMES]; /* of the holes, if they block */
    double f0;
    rates rates;
    bool blocks, steady; /* steady: a deck that is fed all the time, of this duty */
    screen_duty duty;
} own;

/* The free fraction over time of own->free_time, for k1 and k2. */
static void own_holes(const own *o, double k1, double k2, double *free_fraction) {
    for (int i = 0; i < OWN_TIMES; i++) free_fraction[i] = blocking_free_fraction(o->f0, k1, k2, o->free_time[i]);
}

/* The deck of the fit's model. */
static screen_def own_deck(const own *o, const screen_fit_result *fit) {
    screen_def def = o->def;
    def.domain = &fit->domain;
    def.ratio = fit->ratio;
    def.ratio_mass = fit->ratio_mass;
    if (!o->blocks) return def;
    def.free_points = OWN_TIMES;
    def.free_time = o->free_time;
    def.free_fraction = o->free_fraction;
    return def;
}

/* "A,B" as two numbers; 0 if it is not. */
static int two_numbers(const char *text, double *a, double *b) {
    char *end;
    *a = strtod(text, &end);
    if (end == text || *end != ',') return 0;
    const char *second = end + 1;
    *b = strtod(second, &end);
    return end != second && *end == '\0';
}

/* Size and passing of a sieve curve; returns the number of sieves. */
static int read_curve(const program *self, const char *path, double aperture, double *size, double *passing) {
    sheet_sizes curve;
    char message[600];
    if (sheet_read_sizes(path, NULL, 1, &curve, message, (int)sizeof message))
        program_refuse(self, "psd", path, message);
    if (curve.single)
        program_refuse(self, "psd", path, "a sieve curve: the column passing or retained, not shares of single sizes");
    if (curve.n > OWN_POINTS) program_refuse(self, "psd", path, "a file with at most 500 sieves");
    if (curve.size[curve.n - 1] < aperture && curve.above[0] > 1e-6) {
        snprintf(message, sizeof message,
                 "a curve that reaches the opening of %g mm; of this one %.4g %% are coarser than %g mm",
                 1e3 * aperture, 100.0 * curve.above[0], 1e3 * curve.size[curve.n - 1]);
        program_refuse(self, "psd", path, message);
    }
    common_print("%s\n", curve.how);
    const int n = curve.n;
    memcpy(size, curve.size, (size_t)n * sizeof *size);
    memcpy(passing, curve.amount[0], (size_t)n * sizeof *passing);
    sheet_free_sizes(&curve);
    return n;
}

/* Classes from a sieve curve or a distribution. */
static void own_classes(const program *self, own *o, const char *psd, const char *rosin, const char *lognormal,
                        int classes) {
    static double size[OWN_POINTS], passing[OWN_POINTS];
    const char *name = psd     ? "psd"
                       : rosin ? "rosin-rammler"
                               : "lognormal",
               *given = psd     ? psd
                        : rosin ? rosin
                                : lognormal;
    double d = 0.0, spread = 0.0;
    int n = OWN_POINTS;
    if (psd) n = read_curve(self, psd, o->def.aperture, size, passing);
    else if (!two_numbers(given, &d, &spread) || !(d > 0.0) || !(spread > (rosin ? 0.0 : 1.0)))
        program_refuse(self, name, given,
                       rosin ? "D63,N: size [mm] and exponent, above 0"
                             : "D50,SG: median [mm] and geometric deviation above 1");
    for (int i = 0; i < n && !psd; i++) {
        size[i] = 1e-3 * d * 20.0 * (i + 1) / n;
        passing[i] =
            rosin ? screen_rosin_rammler(size[i], 1e-3 * d, spread) : screen_lognormal(size[i], 1e-3 * d, spread);
    }
    screen_status status =
        screen_classes(n, size, passing, o->def.aperture, classes, o->diameters, NULL, &o->undersize);
    if (status) program_refuse(self, name, given, screen_status_text(status));
    o->def.classes = classes;
}

/* The size of which half is left at a time [m]; NaN if no size is, or the model has no partition curve. */
static double own_d50(const own *o, const screen_def *def, screen_model model, const double *parameter, double time) {
    enum { SIZES = 121 };
    double sizes[SIZES], part[SIZES], feed[SIZES];
    screen_separation measure;
    for (int i = 0; i < SIZES; i++) {
        sizes[i] = o->def.aperture * (i + 1) / 110.0;
        feed[i] = 1.0;
    }
    if (model == SCREEN_SOLDINGER || !(time < HUGE_VAL)) return (double)NAN;
    const screen_status status = screen_partition(def, model, parameter, &o->operation, time, SIZES, sizes, part);
    if (status && status != SCREEN_OUTSIDE) return (double)NAN;
    screen_measure(SIZES, sizes, feed, part, o->def.aperture, &measure);
    return measure.d50;
}

/* What 95 % of n values lie between; sorts them. */
static void range_of(int n, double *values, answer *a) {
    qsort(values, (size_t)n, sizeof(double), ascending);
    a->low = values[(int)(0.025 * n)];
    a->high = values[(int)(0.975 * n)];
}

typedef struct own_answer {
    answer time, d50; /* d50 at the time: [m] */
} own_answer;

/* The time to the recovery and d50 then, with 95 % ranges over parameter sets, each with an error of the model on the
   whole case, and over k1 and k2 where the holes block. */
static own_answer own_time(const own *o, const screen_fit_result *fit, const screen_def *def, uint64_t seed) {
    static double sets[OWN_SETS][SCREEN_MAX_PARAMETERS];
    double times[OWN_SETS], sizes[OWN_SETS], drawn[OWN_TIMES], k1, k2;
    own_answer a = {{HUGE_VAL, NAN, NAN}, {NAN, NAN, NAN}};
    int cut = 0;
    screen_status status =
        screen_time_to(def, fit->model, fit->parameter, &o->operation, o->recovery, o->limit, &a.time.time);
    if (status && status != SCREEN_OUTSIDE) a.time.time = status == SCREEN_NOT_REACHED ? HUGE_VAL : (double)NAN;
    a.d50.time = own_d50(o, def, fit->model, fit->parameter, a.time.time);
    if (screen_sample(fit, NULL, seed, OWN_SETS, &sets[0][0])) return a;
    for (int i = 0; i < OWN_SETS; i++) {
        screen_def other = *def;
        if (o->blocks) {
            draw_rates(&o->rates, &seed, &k1, &k2);
            own_holes(o, k1, k2, drawn);
            other.free_fraction = drawn;
        }
        double wanted = o->recovery + fit->case_error * normal(&seed);
        times[i] = wanted <= 0.0 ? 0.0 : HUGE_VAL;
        if (wanted > 0.0 && wanted < 1.0 &&
            screen_time_to(&other, fit->model, sets[i], &o->operation, wanted, o->limit, &times[i]) != SCREEN_OK)
            if (!(times[i] < HUGE_VAL)) times[i] = HUGE_VAL;
        const double d50 = own_d50(o, &other, fit->model, sets[i], a.time.time);
        if (!isnan(d50)) sizes[cut++] = d50;
    }
    range_of(OWN_SETS, times, &a.time);
    if (cut == OWN_SETS) range_of(cut, sizes, &a.d50);
    return a;
}

/* What a deck of these models does that is fed all the time, and the feed at which it reaches the recovery. */
static void report_steady(json *report, const own *o, const screen_fit_result *fits) {
    enum { PLACES = 20 };
    static double retained[OWN_CLASSES * PLACES];
    static const result_column columns[] = {{"model", NULL, "%s"},
                                            {NULL, "model", "%s"},
                                            {"efficiency", "efficiency", "%.3f"},
                                            {"passed_kg_per_s", "through [kg/s]", "%.3g"},
                                            {"stays_kg_per_s", "over the end [kg/s]", "%.3g"},
                                            {"undersize_in_overflow", "undersize in over", "%.3f"},
                                            {"bed_depth_m", "bed at first [mm]", "%.1f", 1e3},
                                            {"bed_depth_end_m", "last", "%.1f", 1e3},
                                            {"capacity_kg_per_s"},
                                            {NULL, "largest feed [kg/s]", "%s"},
                                            {"capacity", NULL, "%s"}};
    result_table *t = RESULTS(columns);
    for (int m = 0; m < LAB_MODELS; m++) {
        const screen_def def = own_deck(o, &fits[m]);
        screen_flow flow;
        double most;
        const screen_status status = screen_steady(&def, fits[m].model, fits[m].parameter, &o->operation, &o->duty,
                                                   PLACES, retained, NULL, NULL, &flow),
                            limit = screen_capacity(&def, fits[m].model, fits[m].parameter, &o->operation, &o->duty,
                                                    o->recovery, &most);
        char text[100];
        if (status && status != SCREEN_OUTSIDE) flow.efficiency = (double)NAN;
        if (limit && limit != SCREEN_OUTSIDE)
            snprintf(text, sizeof text, "%s",
                     limit == SCREEN_LOAD_UNKNOWN ? "the model does not know the load" : screen_status_text(limit));
        else snprintf(text, sizeof text, "%.3g%s", most, limit == SCREEN_OUTSIDE ? ", outside the fit" : "");
        results_row(t, TEXTS(lab_keys[m], lab_names[m], text, screen_status_text(limit)), flow.efficiency, flow.passed,
                    flow.stays, flow.undersize_in_overflow, flow.depth, flow.depth_end, most);
    }
    results_json(t, report, "deck");
    common_print(
        "Fed with %.3g kg/s, %.3g m x %.3g m, the bed travels with %.3g m/s; largest feed for a recovery of %.4g %%:\n",
        o->duty.feed, o->duty.width, o->duty.length, o->duty.velocity, 100.0 * o->recovery);
    results_print(t);
    results_free(t);
}

static int plan_own(const program *self, const char *path, own *o) {
    static screen_fit_result fits[LAB_MODELS];
    static double low[OWN_CLASSES * OWN_TIMES], high[OWN_CLASSES * OWN_TIMES], mean[OWN_CLASSES * OWN_TIMES];
    double time[OWN_TIMES], y[OWN_TIMES], y_low[OWN_TIMES], y_high[OWN_TIMES];
    lab_read_fits(self, path, fits);
    const double K =
        blocking_toss_indicator(o->operation.frequency, o->operation.amplitude, 0.5 * RIDDLE_PI, 0.0, o->def.gravity);
    common_print(
        "K %.2f: %s\n%d classes of equal mass, %.3g .. %.3g mm, %.3f of the feed below the aperture of %.3g mm\n", K,
        blocking_toss_text(blocking_toss_range(K)), o->def.classes, 1e3 * o->diameters[0],
        1e3 * o->diameters[o->def.classes - 1], o->undersize, 1e3 * o->def.aperture);
    json *report = json_open(self->json);
    json_string(report, "parameters", path);
    json_number(report, "recovery", o->recovery);
    riddle_io_table t =
        riddle_io_table_begin("model|fitted to|time [s]|95 % range|d50 then [mm]|95 % range|outside the fit's range");
    riddle_plot *figure = riddle_plot_new("Undersize still on the deck, by fitted models", 1, LAB_MODELS);
    riddle_io_file *file = csv_open(self->out, "own_retained.csv", "model,time_s,retained,low,high");
    for (int i = 0; i < OWN_TIMES; i++) time[i] = o->limit * i / (OWN_TIMES - 1);
    for (int m = 0; m < LAB_MODELS && !common_interrupted(); m++) {
        const screen_def def = own_deck(o, &fits[m]);
        char a[32], b[32], c[32], words[300];
        const own_answer both = own_time(o, &fits[m], &def, self->seed);
        const answer got = both.time, d50 = both.d50;
        unsigned flags = screen_outside(&fits[m].domain, &def, (screen_model)m, &o->operation,
                                        got.time < HUGE_VAL ? got.time : o->limit);
        riddle_io_table_cell(&t, "%s", lab_names[m]);
        riddle_io_table_cell(&t, "%.4f", fits[m].deviation);
        riddle_io_table_cell(&t, "%s", isnan(got.time) ? "no answer" : seconds(a, got.time, o->limit));
        riddle_io_table_cell(&t, "%s .. %s", seconds(b, got.low, o->limit), seconds(c, got.high, o->limit));
        if (isnan(d50.time)) riddle_io_table_cell(&t, "%s", "-");
        else riddle_io_table_cell(&t, "%.3g", 1e3 * d50.time);
        if (isnan(d50.low)) riddle_io_table_cell(&t, "%s", "-");
        else riddle_io_table_cell(&t, "%.3g .. %.3g", 1e3 * d50.low, 1e3 * d50.high);
        riddle_io_table_cell(&t, "%s", flags ? lab_outside(words, sizeof words, flags) : "nothing");
        json_object_begin(report, lab_keys[m]);
        report_answer(report, "answer", &got);
        results_values(report, {"d50_m", d50.time}, {"d50_low_m", d50.low}, {"d50_high_m", d50.high},
                       {"outside_flags", flags});
        json_string(report, "outside", lab_outside(words, sizeof words, flags));
        json_object_end(report);
        screen_status status =
            screen_fit_band(&def, &fits[m], NULL, &o->operation, OWN_TIMES, time, 0.95, self->seed, mean, low, high);
        if (status) continue;
        double curve[OWN_CLASSES];
        for (int i = 0; i < OWN_TIMES; i++) {
            screen_status one =
                screen_predict(&def, (screen_model)m, fits[m].parameter, &o->operation, 1, &time[i], curve, NULL, NULL);
            y[i] = y_low[i] = y_high[i] = 0.0;
            for (int k = 0; k < def.classes; k++) {
                y[i] += (one && one != SCREEN_OUTSIDE ? (double)NAN : curve[k]) / def.classes;
                y_low[i] += low[k * OWN_TIMES + i] / def.classes;
                y_high[i] += high[k * OWN_TIMES + i] / def.classes;
            }
            csv_line(file, "%s,%.17g,%.17g,%.17g,%.17g", lab_keys[m], time[i], y[i], y_low[i], y_high[i]);
        }
        riddle_plot_panel(figure, 0, m, "time [s]", m ? "" : "undersize retained [-]");
        snprintf(words, sizeof words, "%s%s", lab_names[m], flags ? ", extrapolated" : "");
        riddle_plot_title(figure, words);
        riddle_plot_range_y(figure, 0.0, 1.0);
        riddle_plot_band(figure, "95 % of new data", time, y_low, y_high, OWN_TIMES);
        riddle_plot_line(figure, "predicted", time, y, OWN_TIMES);
        riddle_plot_horizontal(figure, "wanted", 1.0 - o->recovery);
    }
    common_print("Time to %.4g %% of the undersize%s:\n", 100.0 * o->recovery, o->blocks ? ", holes blocking" : "");
    table_end(&t);
    if (o->steady) report_steady(report, o, fits);
    riddle_io_close(file);
    riddle_plot_write(figure, self->out, "own_retained.svg");
    json_program(report, self);
    json_close(report);
    return common_exit_status();
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

/* What the command line says, in its units. */
typedef struct asked {
    const char *diameters, *parameters, *psd, *rosin, *lognormal, *tests; /* the last five: NULL if not given */
    double amplitude, frequency, moisture;                                /* [mm], [Hz], [-] */
    double area, feed, undersize, coarse, opening, wire;                  /* [m2], [kg], [-], [mm], [mm], [mm] */
    double recovery, limit, k1, k2, f0, rate_error, x_h;                  /* [-], [s], [1/s], [1/s], [-], [-], [-] */
    int model, shape, classes;
    screen_duty duty;
    bool own_rates, steady, coarse_given, f0_given; /* own_rates: --k1 and --k2, or --tests */
} asked;

/* Refuses options that contradict each other. */
static void refuse_contradictions(const program *self, const asked *a) {
    static const char *const of_a_deck[4] = {"feed-kg-s", "deck-width-m", "deck-length-m", "travel-m-s"};
    const bool k1 = is_given(self, "k1"), k2 = is_given(self, "k2"), steady = is_given(self, of_a_deck[0]);
    const char *feed = a->psd ? "psd" : a->rosin ? "rosin-rammler" : "lognormal";
    if ((a->psd != NULL) + (a->rosin != NULL) + (a->lognormal != NULL) > 1)
        program_refuse(self, feed, NULL, "one of --psd, --rosin-rammler and --lognormal");
    if (!a->parameters && (a->psd || a->rosin || a->lognormal))
        program_refuse(self, feed, NULL, "only with --parameters");
    if (k1 != k2) program_refuse(self, k1 ? "k1" : "k2", NULL, "both --k1 and --k2, or neither");
    if (a->tests && k1) program_refuse(self, "tests", a->tests, "either --tests or --k1 and --k2");
    for (int i = 1; i < 4; i++)
        if (is_given(self, of_a_deck[i]) != steady)
            program_refuse(self, of_a_deck[steady ? i : 0], NULL,
                           "all of --feed-kg-s, --deck-width-m, --deck-length-m and --travel-m-s, or none");
    if (steady && !a->parameters) program_refuse(self, "feed-kg-s", NULL, "only with --parameters");
}

/* Takes k1 and k2 from the law of the blocking tests. */
static void read_rates(const program *self, const asked *a, blocking_law *law, rates *r) {
    blocking_law_value at;
    read_blocking_law(self, a->tests, law);
    if (blocking_law_at(law, r->K, r->x_h, r->moisture, &at) != BLOCKING_OK)
        program_refuse(self, "tests", a->tests, "tests whose law has a value at this K, --xh and --moisture");
    r->law = law, r->k1 = at.k1, r->k2 = at.k2;
    common_print("Holes by %s: k1 %.4g (95 %% %.4g .. %.4g) 1/s, k2 %.4g (%.4g .. %.4g) 1/s at K %.2f, x_h %.2f, "
                 "moisture %.3g%s\n",
                 a->tests, at.k1, at.k1_low95, at.k1_high95, at.k2, at.k2_low95, at.k2_high95, r->K, r->x_h,
                 r->moisture, at.outside ? ", OUTSIDE the tests" : "");
}

static screen_operation operation_of(const asked *a) {
    screen_operation operation = {1e-3 * a->amplitude, a->frequency, a->moisture, 0.0};
    return operation;
}

/* Sets the deck and its batch, of which a share can pass. */
static void set_deck(screen_def *def, const asked *a, double undersize) {
    def->aperture = 1e-3 * a->opening;
    def->wire = 1e-3 * a->wire;
    def->deck_area = a->area;
    def->undersize_mass = a->feed * undersize;
    def->oversize_mass = a->feed * (1.0 - undersize);
    def->coarse_diameter = 1e-3 * a->coarse;
}

static void check_deck(const program *self, const screen_def *def, const char *diameters) {
    const char *field = NULL;
    if (screen_check_def(def, &field) == SCREEN_OK) return;
    const bool sizes = strcmp(field, "diameters") == 0;
    program_refuse(self, sizes ? "diameters-mm" : "opening-mm", sizes ? diameters : NULL,
                   "grain sizes above 0 and below the opening");
}

/* Predicts by the parameters that screen_fit has found. */
static int plan_by_fits(const program *self, const asked *a, const rates *r) {
    static own o;
    o.def = screen_default_def();
    o.def.aperture = 1e-3 * a->opening;
    o.def.diameters = o.diameters;
    o.undersize = a->undersize;
    const bool curve = a->psd || a->rosin || a->lognormal;
    if (curve) own_classes(self, &o, a->psd, a->rosin, a->lognormal, a->classes);
    else o.def.classes = read_diameters(a->diameters, o.diameters);
    if (o.def.classes == 0) program_refuse(self, "diameters-mm", a->diameters, "up to 8 numbers and commas, as 5,7");
    set_deck(&o.def, a, o.undersize);
    if (!a->coarse_given) o.def.coarse_diameter = 1.25 * o.def.aperture;
    o.operation = operation_of(a);
    o.recovery = a->recovery;
    o.limit = a->limit;
    o.blocks = a->own_rates;
    o.f0 = a->f0;
    o.rates = *r;
    for (int i = 0; i < OWN_TIMES; i++) o.free_time[i] = a->limit * i / (OWN_TIMES - 1);
    own_holes(&o, r->k1, r->k2, o.free_fraction);
    o.steady = a->steady;
    o.duty = a->duty;
    check_deck(self, &o.def, curve ? NULL : a->diameters);
    if (screen_check_operation(&o.operation) != SCREEN_OK)
        program_refuse(self, "amplitude-mm", NULL, screen_status_text(screen_check_operation(&o.operation)));
    return plan_own(self, a->parameters, &o);
}

/* ---- by the published parameters ---- */

static blocking_average average_by_table3(const asked *a, const plan *p, double K) {
    blocking_conditions conditions = blocking_default_conditions();
    blocking_average average;
    conditions.K = K;
    conditions.x_h = a->x_h;
    conditions.opening = 1e-3 * a->opening;
    conditions.grain_min = conditions.grain_max = 1e-3 * a->coarse;
    for (int c = 0; c < p->def.classes; c++) conditions.grain_min = fmin(conditions.grain_min, p->diameters[c]);
    conditions.moisture = a->moisture;
    blocking_average_free((blocking_shape)a->shape, &conditions, &average);
    return average;
}

static void print_table3(const blocking_average *average) {
    if (!(average->flags & BLOCKING_FLAG_BOX)) {
        common_print("Table 3 applies: mean free fraction %.3f\n\n", average->value);
        return;
    }
    const char *separator = "Table 3 is not offered:";
    for (unsigned flag = 1; flag < BLOCKING_FLAG_BOX; flag *= 2) {
        if (!(average->flags & flag)) continue;
        common_print("%s %s", separator, blocking_flag_text(flag));
        separator = ";";
    }
    common_print("\n\n");
}

static void print_setting(const asked *a, const plan *p, const holes *h, const rates *r, unsigned outside) {
    const double open = blocking_open_area(a->opening, a->wire);
    char words[300];
    common_print("K %.2f: %s\n", r->K, blocking_toss_text(blocking_toss_range(r->K)));
    common_print("Load %.1f kg/m2; clearance A0 %.3f, effective area in the long run %.4f m2 of %.4f m2 of holes\n",
                 a->feed / a->area, open, blocking_effective_area(h->f_inf, a->area, open), a->area * open);
    common_print("Blocking: f0 %.3f, f_inf %.3f, k1 %.4f 1/s, k2 %.4f 1/s%s\n", h->f0, h->f_inf, r->k1, r->k2,
                 a->own_rates ? "" : ", an illustration (Table 2, fit 7b: dry, 1 mm): give --k1 and --k2");
    if (outside)
        common_print("Beyond what the published parameters were fitted to, so extrapolated: %s\n",
                     lab_outside(words, sizeof words, outside));
    if (fabs(free_holes(p) - 1.0) > 0.01)
        common_print("Load: the models were fitted at %.1f kg/m2; passing is taken %.2f times as fast\n",
                     study_feed / study_area, free_holes(p));
}

static void report_setting(json *report, const asked *a, const holes *h, const rates *r, unsigned outside,
                           const blocking_average *average) {
    const bool offered = !(average->flags & BLOCKING_FLAG_BOX);
    char words[300];
    results_values(report, {"recovery", a->recovery}, {"toss_indicator", r->K}, {"load_kg_per_m2", a->feed / a->area},
                   {"f0", h->f0}, {"f_inf", h->f_inf}, {"k1_per_s", r->k1}, {"k2_per_s", r->k2});
    json_bool(report, "rates_are_yours", a->own_rates);
    json_string(report, "extrapolated", lab_outside(words, sizeof words, outside));
    json_bool(report, "table3_offered", offered);
    json_number(report, "table3_mean_free", offered ? average->value : (double)NAN);
}

/* Times to the recovery by each model: with clean holes, with blocking, and with the mean of Table 3 where that is
   offered (else NULL). */
static void report_times(const program *self, json *report, const plan *p, const holes *blocking, const holes *table3,
                         const rates *r) {
    const holes *cases[3] = {&clean, blocking, table3};
    const char *const keys[3] = {"clean", "blocking", "table3"};
    const int samples = self->quick ? 200 : SAMPLES;
    riddle_io_table t =
        riddle_io_table_begin(table3 ? "model|clean holes [s]|95 % range|blocking [s]|95 % range|Table 3 [s]|95 % range"
                                     : "model|clean holes [s]|95 % range|blocking [s]|95 % range");
    for (int m = 0; m < MODELS && !common_interrupted(); m++) {
        plan coarse = *p;
        coarse.step = 0.05;
        json_object_begin(report, model_names[m]);
        riddle_io_table_cell(&t, "%s", model_names[m]);
        for (int c = 0; c < (table3 ? 3 : 2); c++) {
            char low[32], high[32];
            answer got = ask(&coarse, m, cases[c], r, samples, self->seed);
            got.time = run(p, m, cases[c], p->recovery, NULL, NULL);
            if (isnan(got.time)) common_fail("the model of %s has no answer for these numbers", model_names[m]);
            riddle_io_table_cell(&t, "%s", seconds(low, got.time, p->limit));
            riddle_io_table_cell(&t, "%s .. %s", seconds(low, got.low, p->limit), seconds(high, got.high, p->limit));
            report_answer(report, keys[c], &got);
        }
        json_object_end(report);
    }
    common_print("Time to %.4g %% of the undersize:\n", 100.0 * p->recovery);
    table_end(&t);
}

static int plan_by_published(const program *self, const asked *a, const rates *r) {
    plan p;
    p.def = screen_default_def();
    p.def.classes = read_diameters(a->diameters, p.diameters);
    if (p.def.classes == 0) program_refuse(self, "diameters-mm", a->diameters, "up to 8 numbers and commas, as 5,7");
    p.def.diameters = p.diameters;
    set_deck(&p.def, a, a->undersize);
    p.operation = operation_of(a);
    p.recovery = a->recovery, p.limit = a->limit, p.step = 0.02;
    check_deck(self, &p.def, a->diameters);
    holes h;
    h.f0 = a->own_rates || a->f0_given ? a->f0 : .949; /* goes with the default k1 and k2 */
    h.k = r->k1 + r->k2;
    h.f_inf = h.k > 0.0 ? blocking_equilibrium(r->k1, r->k2) : h.f0;
    const blocking_average average = average_by_table3(a, &p, r->K);
    const holes table3 = {average.value, average.value, 0.0};
    const screen_domain domain = screen_published_domain();
    const unsigned outside =
        screen_outside(&domain, &p.def, SCREEN_SOLDINGER, &p.operation, 0.0) & ~(unsigned)SCREEN_OUTSIDE_LOAD;
    print_setting(a, &p, &h, r, outside);
    print_table3(&average);
    json *report = json_open(self->json);
    report_setting(report, a, &h, r, outside, &average);
    report_times(self, report, &p, &h, average.flags & BLOCKING_FLAG_BOX ? NULL : &table3, r);
    draw_retained(self, &p, &h, outside != 0);
    draw_map(self, &p, a->model, &h);
    draw_area(self, &p, &h);
    json_program(report, self);
    json_close(report);
    return common_exit_status();
}

int main(int argc, char **argv) {
    asked a;
    memset(&a, 0, sizeof a);
    a.diameters = "5,7", a.amplitude = 1.0, a.frequency = 50.6, a.moisture = 0.025;
    a.area = study_area, a.feed = study_feed, a.undersize = 2.0 / 3.0, a.coarse = 10.0, a.opening = 8.0, a.wire = 2.0;
    a.recovery = 0.9, a.limit = 40.0, a.k1 = blocking_k1(.714, .0101), a.k2 = blocking_k2(.714, .0101), a.f0 = 1.0;
    a.rate_error = 0.3, a.x_h = 0.5, a.model = 2, a.classes = 8;
    option options[] = {
        option_positive("amplitude-mm", "A", &a.amplitude, 10.0, "amplitude of the deck [mm]"),
        option_positive("frequency-hz", "F", &a.frequency, 1000.0, "frequency of the deck [Hz]"),
        option_double("moisture", "M", &a.moisture, 0.0, 0.2, "mass of liquid over mass of grains [-], a fraction"),
        option_positive("area-m2", "F", &a.area, 1000.0, "area of the deck [m2]"),
        option_positive("feed-kg", "M", &a.feed, 1e6, "mass of the batch [kg]"),
        option_double("undersize", "X", &a.undersize, 1e-3, 1.0, "share of the feed that can pass [-]"),
        option_string("diameters-mm", "D,D..", &a.diameters, "undersize classes of equal mass, at most 8 [mm]"),
        option_positive("coarse-mm", "D", &a.coarse, 1000.0, "size of what stays [mm]"),
        option_positive("opening-mm", "L", &a.opening, 1000.0, "size of the holes [mm]"),
        option_double("wire-mm", "W", &a.wire, 0.0, 1000.0, "diameter of the wires [mm]"),
        option_double("recovery", "R", &a.recovery, 0.01, 0.9999, "wanted share of the undersize that has passed [-]"),
        option_double("limit-s", "T", &a.limit, 1.0, 60.0, "longest batch looked at [s]"),
        option_choice("model", &a.model, "dong|subasinghe|soldinger", "model of the map"),
        option_double("k1", "K1", &a.k1, 0.0, 1e3, "rate constant of blocking [1/s]; default: Table 2, fit 7b"),
        option_double("k2", "K2", &a.k2, 0.0, 1e3, "rate constant of unblocking [1/s]; default: Table 2, fit 7b"),
        option_double("f0", "F0", &a.f0, 0.0, 1.0,
                      "free fraction of the holes at the start [-]; 0.949 without --k1 and --k2"),
        option_double("rate-error", "S", &a.rate_error, 0.0, 2.0, "relative standard error of k1 and k2 [-]"),
        option_double("xh", "X", &a.x_h, 0.0, 1.0, "hard-to-screen content of the feed [-], for Table 3"),
        option_choice("shape", &a.shape, "spherical|irregular|sharp|sharp-repaired", "grains, for Table 3"),
        option_string("parameters", "FILE", &a.parameters, "parameters.json of screen_fit --data: predict by these"),
        option_string("psd", "FILE", &a.psd, "sieve curve: columns size and passing; with --parameters"),
        option_string("rosin-rammler", "D63,N", &a.rosin, "feed: size [mm] and exponent; with --parameters"),
        option_string("lognormal", "D50,SG", &a.lognormal,
                      "feed: median [mm] and geometric deviation; with --parameters"),
        option_int("classes", "N", &a.classes, 1, OWN_CLASSES,
                   "classes that a sieve curve or distribution is cut into"),
        option_string("tests", "FILE", &a.tests,
                      "counts of blocking tests: k1 and k2 by their law at this K, --xh and --moisture"),
        option_positive("feed-kg-s", "M", &a.duty.feed, 1e6,
                        "a deck fed all the time: its feed [kg/s]; with --parameters, as the next three"),
        option_positive("deck-width-m", "W", &a.duty.width, 100.0, "its width [m]"),
        option_positive("deck-length-m", "L", &a.duty.length, 1000.0, "its length [m]"),
        option_positive("travel-m-s", "V", &a.duty.velocity, 100.0,
                        "velocity of the bed along it [m/s]: measured, or by screen_deck"),
    };
    program self =
        program_start("wet_screen_designer",
                      "Time to a wanted recovery on a wet screen, with blocking and without, and its uncertainty.",
                      options, (int)(sizeof options / sizeof *options), argc, argv);
    refuse_contradictions(&self, &a);
    a.own_rates = is_given(&self, "k1") || a.tests;
    a.steady = is_given(&self, "feed-kg-s"), a.coarse_given = is_given(&self, "coarse-mm"),
    a.f0_given = is_given(&self, "f0");
    rates r = {a.k1,
               a.k2,
               a.rate_error,
               NULL,
               blocking_toss_indicator(a.frequency, 1e-3 * a.amplitude, 0.5 * RIDDLE_PI, 0.0, 9.81),
               a.x_h,
               a.moisture};
    blocking_law law;
    if (a.tests) read_rates(&self, &a, &law, &r);
    return a.parameters ? plan_by_fits(&self, &a, &r) : plan_by_published(&self, &a, &r);
}
