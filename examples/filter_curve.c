/* Resistances of filter cake and medium from a measured filter curve, by filtration.h, in the manner of VDI 2762.

   1. curve.svg: t / V over V, the straight stretch, its line with the interval, and the residuals.
   2. prediction.svg: filtrate over time on another filter: --new-area-cm2, --new-pressure-pa, --new-rate-ml-s.

   Your own curve:  filter_curve --data run.csv --pressure-pa 1e5 --area-cm2 20     a laboratory's table
   (common/sheet.h) with columns time and volume or mass of the filtrate, in English or German, with their units;
   pressure and test may be columns, too
   3. compressibility.svg: resistance over pressure, where the table has runs at several pressures.
   Without --data the readings are generated: 14 mL through 20 cm2 at 1000 Pa with R_M0 3.4e6 1/m, as in Puderbach,
   Schmidt & Antonyuk, Processes 9 (2021) 826, R_MI 2e6 1/m, r_K K_S 4.14e9 1/m2 and 0.5 % scatter. The paper's raw
   readings are not printed. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "filtration.h"
#include "sheet.h"

enum { DRAWN = 56, CURVE = 200 };

/* The command line in SI units. */
typedef struct settings {
    const char *data;
    filtration_curve_def def;
    double clean_volume; /* [m3]; 0: no clean stretch */
    double setup;        /* resistance of the empty set-up [1/m] */
    double density;      /* of the filtrate [kg/m3] */
    double cake_height;  /* at the end [m]; 0: unknown */
    double sauter;       /* of the particles [m]; 0: unknown */
    double new_area, new_pressure, new_rate, new_volume, compressibility;
} settings;

typedef struct readings {
    double *time, *volume; /* [n] [s] [m3] */
    size_t n;
    double pressure; /* difference [Pa] */
    char name[40];   /* of the run */
} readings;

typedef struct runs {
    readings *run; /* [n] */
    size_t n;
} runs;

static void *take(size_t bytes) {
    void *memory = calloc(1, bytes);
    if (!memory) exit((common_fail("out of memory"), common_exit_status()));
    return memory;
}

static readings make_readings(size_t n) {
    readings r;
    memset(&r, 0, sizeof r);
    r.time = take(2 * (n + 1) * sizeof(double)), r.volume = r.time + n + 1;
    return r;
}

/* ---- readings ---- */

enum { TIME, VOLUME, MASS, PRESSURE, TEST, COLUMNS };
static const char *const columns =
    "a table with the columns time and volume or mass (of the filtrate); pressure and test may be columns, too";

static void refuse_file(const program *self, const char *path, const char *reason) {
    char text[1000];
    snprintf(text, sizeof text, "%s; %.800s", columns, reason);
    program_refuse(self, "data", path, text);
}

/* Does another run begin in this row? By another test, a time that falls together with the volume, or
   another pressure. */
static bool begins_a_run(const sheet *table, const sheet_column *c, int i, const readings *r, double volume) {
    if (i == 0) return true;
    if (c[TEST].value) {
        const char *now = table->cell[i * table->columns + c[TEST].index],
                   *before = table->cell[(i - 1) * table->columns + c[TEST].index];
        return strcmp(now, before) != 0;
    }
    if (c[TIME].value[i] < r->time[r->n - 1] && volume < 0.5 * r->volume[r->n - 1]) return true;
    return false;
}

static runs read_runs(const program *self, const settings *s) {
    sheet table;
    char message[1000];
    sheet_column c[COLUMNS] = {sheet_want("time", 'T', true), sheet_want("volume", 'V', false),
                               sheet_want("mass", 'M', false), sheet_want("pressure", 'P', false),
                               sheet_want("test", 't', false)};
    if (sheet_read(s->data, c, COLUMNS, &table, message, sizeof message) != 0) refuse_file(self, s->data, message);
    if (!c[VOLUME].value && !c[MASS].value) { /* say so, with the columns that are there */
        c[VOLUME].needed = true;
        sheet_free(&table);
        if (sheet_read(s->data, c, COLUMNS, &table, message, sizeof message) != 0) refuse_file(self, s->data, message);
    }
    common_print("%s\n", table.how);
    const size_t rows = (size_t)table.rows;
    runs all = {take((rows + 1) * sizeof(readings)), 0};
    readings *r = NULL;
    for (int i = 0; i < table.rows; i++) {
        const double time = c[TIME].value[i];
        const double volume = c[VOLUME].value ? c[VOLUME].value[i] : c[MASS].value[i] / s->density;
        const double pressure = c[PRESSURE].value ? c[PRESSURE].value[i] : s->def.pressure;
        if (begins_a_run(&table, c, i, r, volume)) {
            r = &all.run[all.n++];
            *r = make_readings(rows);
            r->pressure = pressure;
            snprintf(r->name, sizeof r->name, "%s", c[TEST].value ? table.cell[i * table.columns + c[TEST].index] : "");
        }
        const char *wrong = !isfinite(time) || !(volume >= 0.0)       ? "not a number, or negative"
                            : r->n > 0 && time < r->time[r->n - 1]    ? "before the row above"
                            : !(pressure > 0.0 && isfinite(pressure)) ? "its pressure is not above 0"
                            : fabs(pressure / r->pressure - 1.0) > 0.05
                                ? "its pressure is not that of the run within 5 % (a run has one pressure)"
                                : NULL;
        if (wrong) {
            snprintf(message, sizeof message, "%s:%d: time %g s, filtrate %g m3, %g Pa: %s", s->data, table.line[i],
                     time, volume, pressure, wrong);
            refuse_file(self, s->data, message);
        }
        r->time[r->n] = time, r->volume[r->n++] = volume;
    }
    sheet_free(&table);
    if (all.n == 0) refuse_file(self, s->data, "no row");
    return all;
}

/* The paper's shape: the clean medium up to 1 mm of suspension (2 mL), from 3 mm (6 mL) on the line of the cake. */
static runs draw_readings(const settings *s, uint64_t seed) {
    const double slope = filtration_slope(4.14e9, s->def.pressure, s->def.viscosity, s->def.area);
    const double clean = filtration_intercept(3.4e6, s->def.pressure, s->def.viscosity, s->def.area);
    const double blocked = filtration_intercept(5.4e6, s->def.pressure, s->def.viscosity, s->def.area);
    const runs all = {take(sizeof(readings)), 1};
    readings r = make_readings(DRAWN);
    r.n = DRAWN, r.pressure = s->def.pressure;
    for (int i = 0; i < DRAWN; i++) {
        const double V = r.volume[i] = 7e-3 * s->def.area * (i + 1) / DRAWN;
        const double x = fmin(fmax((V / s->def.area - 1e-3) / 2e-3, 0.0), 1.0), share = x * x * (3.0 - 2.0 * x);
        const double normal = sqrt(-2.0 * log(random_inner(&seed))) * cos(6.283185307179586 * random_inner(&seed));
        r.time[i] = V * (clean + share * (slope * V + blocked - clean)) * (1.0 + 0.005 * normal);
        if (i > 0) r.time[i] = fmax(r.time[i], r.time[i - 1]);
    }
    *all.run = r;
    return all;
}

/* ---- results ---- */

static void report_estimate(json *report, const char *key, const filtration_estimate *e) {
    json_object_begin(report, key);
    results_values(report, {"value", e->value}, {"standard_error", e->error}, {"low", e->low}, {"high", e->high});
    json_object_end(report);
}

/* On the screen, where it has a number, and in the report. */
static void tell_estimate(json *report, riddle_io_table *t, const char *key, const char *name, const char *unit,
                          const filtration_estimate *e) {
    report_estimate(report, key, e);
    if (isnan(e->value)) return;
    riddle_io_table_cell(t, "%s", name);
    riddle_io_table_cell(t, "%.4g", e->value);
    riddle_io_table_cell(t, isfinite(e->error) ? "%.2g" : "none", e->error);
    riddle_io_table_cell(t, isfinite(e->low) ? "%.4g .. %.4g" : "none", e->low, e->high);
    riddle_io_table_cell(t, "%s", unit);
}

static void tell_curve(json *report, const settings *s, const readings *r, const filtration_curve *c,
                       const filtration_estimate *clean) {
    common_print("Straight stretch: readings %zu to %zu, %.3g to %.3g mL; %zu readings, scatter %.2g %%, R2 %.5f\n",
                 c->first + 1, c->last + 1, 1e6 * r->volume[c->first], 1e6 * r->volume[c->last], c->used,
                 100.0 * c->scatter, c->r2);
    common_print("Intervals of %.3g %%: Student's t %.3f with %.3g degrees of freedom\n\n", 100.0 * c->confidence,
                 c->student, c->freedom);
    json_string(report, "source", s->data ? s->data : "drawn from the paper's numbers");
    results_values(report, {"readings", (double)r->n}, {"pressure_pa", s->def.pressure},
                   {"viscosity_pa_s", s->def.viscosity}, {"area_m2", s->def.area}, {"cake_ratio", s->def.cake_ratio});
    json_object_begin(report, "stretch");
    results_values(report, {"first", (double)c->first}, {"last", (double)c->last}, {"used", (double)c->used},
                   {"from_m3", r->volume[c->first]}, {"to_m3", r->volume[c->last]}, {"scatter", c->scatter},
                   {"bend", c->bend}, {"correlation", c->correlation}, {"r2", c->r2},
                   {"degrees_of_freedom", c->freedom}, {"student_t", c->student}, {"confidence", c->confidence});
    json_object_end(report);
    riddle_io_table t = riddle_io_table_begin("|value|standard error|interval|unit");
    tell_estimate(report, &t, "slope_s_per_m6", "slope", "s/m6", &c->slope);
    tell_estimate(report, &t, "intercept_s_per_m3", "intercept", "s/m3", &c->intercept);
    tell_estimate(report, &t, "r_k_k_s_per_m2", "r_K K_S", "1/m2", &c->product);
    tell_estimate(report, &t, "r_k_per_m2", "specific cake resistance r_K", "1/m2", &c->cake);
    tell_estimate(report, &t, "alpha_m_per_kg", "alpha", "m/kg", &c->by_mass);
    tell_estimate(report, &t, "r_m_per_m", "medium R_M", "1/m", &c->medium);
    if (s->clean_volume > 0.0) tell_estimate(report, &t, "r_m0_per_m", "clean medium R_M0", "1/m", clean);
    table_end(&t);
    if (s->clean_volume > 0.0)
        common_print("\nInterference of the first layer R_MI = R_M - R_M0: %.3g 1/m\n", c->medium.value - clean->value);
    if (s->sauter > 0.0 && c->cake.value > 0.0)
        common_print("Porosity that Kozeny and Carman would give r_K at %.3g um: %.3f\n", 1e6 * s->sauter,
                     filtration_kozeny_porosity(c->cake.value, s->sauter, FILTRATION_KOZENY_CARMAN));
    json_array_begin(report, "remarks");
    for (unsigned bit = 1; bit <= FILTRATION_REMARK_DRIFT; bit *= 2)
        if (c->remarks & bit) {
            common_print("Remark: %s\n", filtration_remark_text(bit));
            json_string(report, NULL, filtration_remark_text(bit));
        }
    json_array_end(report);
}

/* Ordinate (t - t1) / (V - V1) over V, as measured and on the line with its interval; the residuals below. */
static void draw_curve(const program *self, const settings *s, const readings *r, const filtration_curve *c) {
    const double t1 = s->def.start_time, V1 = s->def.start_volume, largest = r->volume[r->n - 1];
    double *x = malloc(6 * (r->n + 1) * sizeof *x), *y = x + r->n + 1, *used_x = y + r->n + 1,
           *used_y = used_x + r->n + 1;
    double *rest = used_y + r->n + 1;
    if (!x) exit((common_fail("out of memory"), common_exit_status()));
    int n = 0, used = 0;
    result_table *t = results_of("time_s,volume_m3,time_over_volume_s_per_m3,line_s_per_m3,used");
    for (size_t i = 0; i < r->n; i++) {
        const double ordinate = (r->time[i] - t1) / (r->volume[i] - V1),
                     line = c->intercept.value + c->slope.value * (r->volume[i] + V1);
        const int counts = i >= c->first && i <= c->last && r->volume[i] > V1 && r->time[i] > t1;
        if (!(r->volume[i] > V1 && r->time[i] > t1)) continue;
        results_row(t, NULL, r->time[i], r->volume[i], ordinate, line, counts);
        if (counts)
            used_x[used] = 1e6 * r->volume[i], used_y[used] = 1e-6 * ordinate,
            rest[used++] = 100.0 * (ordinate / line - 1.0);
        else x[n] = 1e6 * r->volume[i], y[n++] = 1e-6 * ordinate;
    }
    results_csv(t, self->out, "filter_curve.csv");
    results_free(t);
    double V[CURVE], line[CURVE], low[CURVE], high[CURVE];
    for (int i = 0; i < CURVE; i++) {
        const double at = largest * i / (CURVE - 1) + V1, from = c->slope.error * at, of = c->intercept.error;
        const double error = isfinite(of) ? sqrt(fmax(from * from + of * of + 2.0 * at * c->covariance, 0.0)) : 0.0;
        V[i] = 1e6 * (at - V1), line[i] = 1e-6 * (c->intercept.value + c->slope.value * at);
        low[i] = line[i] - 1e-6 * c->student * error, high[i] = line[i] + 1e-6 * c->student * error;
    }
    riddle_plot *figure = riddle_plot_new("Filter curve", 1, 2);
    riddle_plot_panel(figure, 0, 0, "filtrate V [mL]",
                      V1 > 0.0 || t1 != 0.0 ? "(t − t₁) / (V − V₁) [s/mL]" : "t / V [s/mL]");
    if (isfinite(c->intercept.error)) riddle_plot_band(figure, "interval of the line", V, low, high, CURVE);
    riddle_plot_line(figure, "line", V, line, CURVE);
    riddle_plot_points(figure, "readings used", used_x, used_y, used);
    if (n > 0) {
        riddle_plot_points(figure, "other readings", x, y, n);
        riddle_plot_style(figure, 0, RIDDLE_PLOT_GREY);
    }
    riddle_plot_panel(figure, 0, 1, "filtrate V [mL]", "reading over line − 1 [%]");
    riddle_plot_points(figure, "", used_x, rest, used);
    riddle_plot_horizontal(figure, "", 0.0);
    riddle_plot_write(figure, self->out, "curve.svg");
    free(x);
}

/* ---- prediction ---- */

static filtration_operation new_operation(const settings *s, const filtration_curve *c) {
    filtration_operation o = filtration_operation_default();
    o.viscosity = c->viscosity, o.area = s->new_area, o.pressure = s->new_pressure, o.rate = s->new_rate;
    o.product = fmax(c->product.value, 0.0), o.medium = fmax(c->medium.value, 0.0);
    /* the resistance was measured where the cake had this part of the pressure, in the middle of the run */
    const double cake = o.product * 0.5 * c->largest / c->area;
    o.compressibility = s->compressibility, o.reference = c->pressure * (cake > 0.0 ? cake / (cake + o.medium) : 1.0);
    return o;
}

static void predict(const program *self, json *report, const settings *s, const filtration_curve *c) {
    const filtration_operation o = new_operation(s, c);
    const bool at_pressure = !isfinite(o.rate);
    filtration_point end;
    filtration_estimate time;
    const filtration_status status = filtration_at_volume(&o, s->new_volume, &end);
    filtration_predict(c, o.pressure, o.area, o.compressibility, s->new_volume, &time);
    if (status != FILTRATION_OK) {
        common_fail("no prediction: %s", filtration_status_text(status));
        return;
    }
    common_print("\nOn %.4g cm2 at %.4g Pa%s, %.4g mL of filtrate take %.4g s", 1e4 * o.area, o.pressure,
                 at_pressure ? "" : " at most", 1e6 * s->new_volume, end.time);
    if (at_pressure && c->medium.value >= 0.0 && isfinite(time.low))
        common_print(" (%.4g .. %.4g s by the fit)", time.low, time.high);
    common_print("; at the end %.3g mL/s, %.4g Pa in all, %.4g Pa in the cake\n", 1e6 * end.flow, end.pressure,
                 end.cake);
    if (c->medium.value < 0.0) common_print("R_M was taken as 0 for it.\n");
    const unsigned outside = filtration_outside(c, o.pressure, o.area, s->new_volume);
    for (unsigned flag = 1; flag <= FILTRATION_OUTSIDE_PRESSURE; flag *= 2)
        if (outside & flag) common_print("An extrapolation: %s.\n", filtration_outside_text(flag));
    json_object_begin(report, "prediction");
    results_values(report, {"area_m2", o.area}, {"pressure_pa", o.pressure}, {"rate_m3_per_s", o.rate},
                   {"compressibility", o.compressibility}, {"volume_m3", s->new_volume}, {"time_s", end.time});
    if (at_pressure) report_estimate(report, "time_by_fit_s", &time);
    results_values(report, {"flow_m3_per_s", end.flow}, {"pressure_end_pa", end.pressure},
                   {"pressure_in_cake_pa", end.cake}, {"outside_flags", outside});
    json_object_end(report);

    double low[CURVE], high[CURVE];
    result_table *course = results_of("time_s,volume_m3,flow_m3_per_s,pressure_pa,cake_pa");
    for (int i = 0; i < CURVE; i++) {
        filtration_point p;
        if (filtration_at_volume(&o, s->new_volume * (i + 1) / CURVE, &p) != FILTRATION_OK) p = end;
        filtration_predict(c, o.pressure, o.area, o.compressibility, p.volume, &time);
        low[i] = time.low, high[i] = time.high;
        results_row(course, NULL, p.time, p.volume, p.flow, p.pressure, p.cake);
    }
    results_csv(course, self->out, "prediction.csv");
    const double *V = results_column(course, "volume_m3", 1e6), *t = results_column(course, "time_s", 1.0);
    riddle_plot *figure =
        riddle_plot_new(outside ? "Prediction, outside the readings" : "Prediction", 1, at_pressure ? 2 : 3);
    riddle_plot_panel(figure, 0, 0, "filtrate V [mL]", "time [s]");
    if (at_pressure && isfinite(time.low)) riddle_plot_band(figure, "interval of the fit", V, low, high, CURVE);
    riddle_plot_line(figure, "time", V, t, CURVE);
    if (outside & FILTRATION_OUTSIDE_MORE)
        riddle_plot_vertical(figure, "readings end here", 1e6 * c->largest * o.area / c->area);
    riddle_plot_panel(figure, 0, 1, "time [s]", "filtrate flow [mL/s]");
    riddle_plot_line(figure, "", t, results_column(course, "flow_m3_per_s", 1e6), CURVE);
    if (!at_pressure) {
        riddle_plot_panel(figure, 0, 2, "time [s]", "pressure difference [Pa]");
        riddle_plot_line(figure, "", t, results_column(course, "pressure_pa", 1.0), CURVE);
    }
    riddle_plot_write(figure, self->out, "prediction.svg");
    results_free(course);
}

/* ---- the command line ---- */

/* The command line as typed, in its units. */
typedef struct typed {
    double pressure, viscosity, area, ratio, height, from, to, start_time, start_volume, clean, setup, density, sauter,
        time_error, volume_error, drift_error, pressure_error, area_error, viscosity_error, ratio_error, solids,
        solids_error, reference, confidence, new_area, new_pressure, new_rate, new_volume, compressibility;
    bool whole, independent;
} typed;

static settings in_si(const program *self, const typed *t, const char *data) {
    settings s;
    memset(&s, 0, sizeof s);
    s.data = data, s.def = filtration_curve_default_def();
    filtration_curve_def *d = &s.def;
    d->pressure = t->pressure, d->viscosity = t->viscosity, d->area = 1e-4 * t->area,
    d->cake_ratio = t->ratio > 0.0 ? t->ratio : (double)NAN;
    d->pressure_error = 0.01 * t->pressure_error, d->area_error = 0.01 * t->area_error,
    d->cake_ratio_error = 0.01 * t->ratio_error;
    d->viscosity_error = 0.01 * t->viscosity_error, d->time_error = t->time_error,
    d->volume_error = 1e-6 * t->volume_error;
    d->drift_error = 1e-6 * t->drift_error, d->independent = t->independent;
    d->solids = t->solids > 0.0 ? t->solids : (double)NAN, d->solids_error = 0.01 * t->solids_error;
    d->start_time = t->start_time, d->start_volume = 1e-6 * t->start_volume;
    d->first_volume = 1e-6 * t->from, d->last_volume = 1e-6 * t->to, d->automatic = !t->whole,
    d->confidence = 0.01 * t->confidence;
    s.clean_volume = 1e-6 * t->clean, s.setup = t->setup, s.density = t->density, s.cake_height = 1e-3 * t->height,
    s.sauter = 1e-6 * t->sauter;
    s.new_area = d->area, s.new_pressure = d->pressure, s.new_rate = HUGE_VAL, s.compressibility = t->compressibility;
    if (is_given(self, "new-area-cm2")) s.new_area = 1e-4 * t->new_area;
    if (is_given(self, "new-pressure-pa")) s.new_pressure = t->new_pressure;
    if (is_given(self, "new-rate-ml-s")) s.new_rate = 1e-6 * t->new_rate;
    if (is_given(self, "new-volume-ml")) s.new_volume = 1e-6 * t->new_volume;
    return s;
}

/* Evaluates a run, or leaves with what the data lack. */
static filtration_curve evaluate(const program *self, const settings *s, const readings *r,
                                 filtration_estimate *clean) {
    filtration_curve c;
    char text[300];
    filtration_curve_def def = s->def;
    def.pressure = r->pressure;
    filtration_status status = filtration_evaluate(&def, r->n, r->time, r->volume, &c);
    if (status == FILTRATION_FEW_DATA) {
        size_t count = 0;
        for (size_t i = 0; i < r->n; i++)
            count += r->volume[i] > def.start_volume && r->time[i] > def.start_time &&
                     r->volume[i] >= def.first_volume && r->volume[i] <= def.last_volume;
        snprintf(text, sizeof text, "%s%s: %zu readings count, and a line with its interval needs 3",
                 r->name[0] ? "test " : "this one", r->name, count);
        if (s->data) refuse_file(self, s->data, text);
        program_refuse(self, "from-ml", NULL, "a stretch with at least 3 readings");
    }
    if (status == FILTRATION_OK && s->clean_volume > 0.0) {
        status = filtration_evaluate_clean(&def, r->n, r->time, r->volume, s->clean_volume, clean);
        if (status == FILTRATION_FEW_DATA)
            program_refuse(self, "clean-ml", NULL, "a volume below which there are at least 2 readings");
    }
    if (status == FILTRATION_BAD_ARGUMENT && s->data) /* all else was checked row by row */
        refuse_file(self, s->data,
                    "the filtrate falls by more than scatter: several filtrations in a file need a column test, or "
                    "times that begin anew");
    if (status != FILTRATION_OK && s->data) refuse_file(self, s->data, filtration_status_text(status));
    if (status != FILTRATION_OK) program_refuse(self, "from-ml", NULL, "a stretch with at least 3 readings");
    filtration_estimate *of_medium[] = {&c.medium, clean}; /* what the empty set-up resists is not the medium's */
    for (int i = 0; i < 2; i++)
        of_medium[i]->value -= s->setup, of_medium[i]->low -= s->setup, of_medium[i]->high -= s->setup;
    return c;
}

/* ---- several runs: the law of the cake's resistance over pressure ---- */

/* The resistance that the runs have in common: alpha or r_K if the data give it, else r_K K_S. */
static const filtration_estimate *resistance(const filtration_curve *c) {
    return isfinite(c->by_mass.value) ? &c->by_mass : isfinite(c->cake.value) ? &c->cake : &c->product;
}

static void draw_law(const program *self, size_t n, const double *pressure, const double *value,
                     const filtration_compressibility *law, const char *axis) {
    double p[CURVE], on[CURVE], low[CURVE], high[CURVE], *x = take(2 * n * sizeof *x), *y = x + n;
    filtration_estimate e;
    for (size_t i = 0; i < n; i++) x[i] = 1e-5 * pressure[i], y[i] = value[i];
    for (int i = 0; i < CURVE; i++) {
        const double at = law->lowest * pow(law->highest / law->lowest, i / (CURVE - 1.0));
        filtration_value_at_pressure(law, at, &e);
        p[i] = 1e-5 * at, on[i] = e.value, low[i] = e.low, high[i] = e.high;
    }
    riddle_plot *figure = riddle_plot_new("Compressibility of the cake", 1, 1);
    riddle_plot_panel(figure, 0, 0, "pressure difference [bar]", axis);
    if (isfinite(low[0])) riddle_plot_band(figure, "interval of the law", p, low, high, CURVE);
    riddle_plot_line(figure, "power law", p, on, CURVE);
    riddle_plot_points(figure, "runs", x, y, (int)n);
    riddle_plot_write(figure, self->out, "compressibility.svg");
    free(x);
}

/* Fits the law and tells it. Returns the exponent, or 0 where the runs have no law. */
static double fit_law(const program *self, json *report, const settings *s, double reference, const runs *all,
                      const filtration_curve *c) {
    double *pressure = take(3 * all->n * sizeof *pressure), *value = pressure + all->n, *error = value + all->n;
    const char *name = isfinite(c->by_mass.value) ? "alpha" : isfinite(c->cake.value) ? "r_K" : "r_K K_S";
    const char *unit = isfinite(c->by_mass.value) ? "m/kg" : "1/m2";
    char axis[40];
    snprintf(axis, sizeof axis, "%s [%s]", name, unit);
    riddle_io_table t = riddle_io_table_begin("run|pressure [Pa]|readings used|value|interval|R_M [1/m]");
    json_array_begin(report, "runs");
    for (size_t i = 0; i < all->n; i++) {
        const filtration_estimate *e = resistance(&c[i]);
        pressure[i] = all->run[i].pressure, value[i] = e->value, error[i] = c[i].slope.error / c[i].slope.value;
        riddle_io_table_cell(&t, all->run[i].name[0] ? "%s" : "%s%zu", all->run[i].name, i + 1);
        riddle_io_table_cell(&t, "%.4g", pressure[i]);
        riddle_io_table_cell(&t, "%zu of %zu", c[i].used, all->run[i].n);
        riddle_io_table_cell(&t, "%.4g", e->value);
        riddle_io_table_cell(&t, isfinite(e->low) ? "%.4g .. %.4g" : "none", e->low, e->high);
        riddle_io_table_cell(&t, "%.3g", c[i].medium.value);
        json_object_begin(report, NULL);
        json_string(report, "run", all->run[i].name);
        json_number(report, "pressure_pa", pressure[i]);
        json_integer(report, "used", (long long)c[i].used);
        report_estimate(report, "value", e);
        report_estimate(report, "r_m_per_m", &c[i].medium);
        json_integer(report, "remark_flags", c[i].remarks);
        json_object_end(report);
    }
    json_array_end(report);
    common_print("\n%zu runs: %s [%s]\n\n", all->n, name, unit);
    table_end(&t);
    for (size_t i = 0; i < all->n; i++)
        for (unsigned bit = 1; bit <= FILTRATION_REMARK_DRIFT; bit *= 2)
            if (c[i].remarks & bit) common_print("Run %zu: %s\n", i + 1, filtration_remark_text(bit));
    filtration_compressibility law;
    const filtration_status status =
        filtration_fit_compressibility(all->n, pressure, value, error, reference, s->def.confidence, &law);
    json_object_begin(report, "compressibility");
    json_string(report, "of", axis);
    report_estimate(report, "exponent", &law.exponent);
    report_estimate(report, "at_reference", &law.at_reference);
    json_number(report, "reference_pa", law.reference);
    json_number(report, "between_runs", law.between);
    json_object_end(report);
    if (status == FILTRATION_NO_SOLUTION)
        common_print("\nAll runs have one pressure: no compressibility follows from them.\n");
    else if (status != FILTRATION_OK) common_print("\nNo compressibility: a run has no resistance above 0.\n");
    if (status == FILTRATION_OK) {
        common_print("\n%s = %.4g %s (dp / %.4g Pa)^%.3f", name, law.at_reference.value, unit, law.reference,
                     law.exponent.value);
        if (isfinite(law.exponent.low))
            common_print("\n%.3g %%: factor %.4g .. %.4g, exponent %.3f .. %.3f; runs scatter by %.2g %% beyond their "
                         "own errors\n",
                         100.0 * law.confidence, law.at_reference.low, law.at_reference.high, law.exponent.low,
                         law.exponent.high, 100.0 * law.between);
        else common_print("; its intervals need 3 runs\n");
        draw_law(self, all->n, pressure, value, &law, axis);
    }
    free(pressure);
    return status == FILTRATION_OK ? fmin(fmax(law.exponent.value, 0.0), 0.99) : 0.0;
}

int main(int argc, char **argv) {
    const char *data = NULL;
    typed t;
    memset(&t, 0, sizeof t);
    t.pressure = 1000.0, t.viscosity = 1e-3, t.area = 20.0, t.to = HUGE_VAL, t.density = 998.2, t.confidence = 95.0,
    t.reference = 1e5;
    option options[] = {
        option_string("data", "FILE", &data,
                      "filter curve: table with time and volume or mass; pressure and test if there are several runs"),
        option_positive("pressure-pa", "DP", &t.pressure, 1e12,
                        "pressure difference, constant [Pa]; a column pressure goes before it"),
        option_positive("viscosity-pa-s", "MU", &t.viscosity, 1e6, "viscosity of the filtrate [Pa s]"),
        option_positive("area-cm2", "A", &t.area, 1e12, "filter area [cm2]"),
        option_positive("cake-ratio", "KS", &t.ratio, 1e3,
                        "cake volume over filtrate volume K_S [-]; without it only r_K K_S is found"),
        option_positive("solids-kg-m3", "C", &t.solids, 1e5,
                        "mass of dry solids in the cake over the volume of filtrate [kg/m3]: gives alpha"),
        option_positive("cake-height-mm", "H", &t.height, 1e6, "instead: height of the cake at the last reading [mm]"),
        option_positive("density", "RHO", &t.density, 1e5, "of the filtrate, for mass_g [kg/m3]"),
        option_double("from-ml", "V", &t.from, 0.0, 1e15, "use readings from here on [mL]"),
        option_positive("to-ml", "V", &t.to, 1e15, "use readings up to here [mL]; default: all"),
        option_flag("whole", &t.whole, "use all of them, not their longest straight stretch"),
        option_double("start-s", "T", &t.start_time, -1e12, 1e12, "time at which the stage began [s]"),
        option_double("start-ml", "V", &t.start_volume, 0.0, 1e15, "filtrate by then [mL]"),
        option_double("clean-ml", "V", &t.clean, 0.0, 1e15, "the medium was clean up to here [mL]: gives R_M0"),
        option_double("setup-per-m", "R", &t.setup, 0.0, 1e30,
                      "resistance of the set-up without the medium, subtracted [1/m]"),
        option_positive("sauter-um", "D", &t.sauter, 1e6,
                        "Sauter diameter of the particles [um]: porosity by Kozeny and Carman"),
        option_double("time-error-s", "S", &t.time_error, 0.0, 1e12,
                      "standard error of a time [s]: weighs the readings"),
        option_double("volume-error-ml", "S", &t.volume_error, 0.0, 1e15,
                      "standard error of a volume [mL]: weighs the readings"),
        option_double("drift-error-ml", "S", &t.drift_error, 0.0, 1e15,
                      "standard error of the last volume by a balance that drifts [mL]"),
        option_flag("independent", &t.independent,
                    "errors of neighbouring readings are independent: narrower intervals"),
        option_double("pressure-error-pct", "S", &t.pressure_error, 0.0, 100.0, "standard error of the pressure [%]"),
        option_double("area-error-pct", "S", &t.area_error, 0.0, 100.0, "standard error of the area [%]"),
        option_double("viscosity-error-pct", "S", &t.viscosity_error, 0.0, 100.0,
                      "standard error of the viscosity [%]"),
        option_double("cake-ratio-error-pct", "S", &t.ratio_error, 0.0, 100.0, "standard error of K_S [%]"),
        option_double("solids-error-pct", "S", &t.solids_error, 0.0, 100.0, "standard error of the mass of solids [%]"),
        option_positive("reference-pa", "DP", &t.reference, 1e12,
                        "pressure at which the law of several runs has its factor [Pa]"),
        option_double("confidence-pct", "C", &t.confidence, 50.0, 99.99, "of the intervals [%]"),
        option_positive("new-area-cm2", "A", &t.new_area, 1e12, "predict for this area [cm2]; default: as measured"),
        option_positive("new-pressure-pa", "DP", &t.new_pressure, 1e12,
                        "predict for this pressure difference [Pa]; default: as measured"),
        option_positive("new-rate-ml-s", "Q", &t.new_rate, 1e12,
                        "at this constant filtrate flow until that pressure is reached [mL/s]"),
        option_positive("new-volume-ml", "V", &t.new_volume, 1e15,
                        "predict up to this filtrate volume [mL]; default: twice the last reading"),
        option_double("compressibility", "N", &t.compressibility, 0.0, 0.99,
                      "exponent of r_K K_S over pressure, for the prediction [-]; default: of the runs, else 0"),
    };
    const int n = (int)(sizeof options / sizeof *options);
    program self =
        program_start("filter_curve", "Resistances of filter cake and medium from a filter curve, and a prediction.",
                      options, n, argc, argv);
    settings s = in_si(&self, &t, data);
    if (t.ratio > 0.0 && t.height > 0.0)
        program_refuse(&self, "cake-height-mm", NULL, "either --cake-ratio or --cake-height-mm");
    if (!(t.to > t.from)) program_refuse(&self, "to-ml", NULL, "above --from-ml");
    runs all = data ? read_runs(&self, &s) : draw_readings(&s, self.seed);
    if (s.cake_height > 0.0 && all.n > 1)
        program_refuse(&self, "cake-height-mm", NULL, "one run; several need --cake-ratio or --solids-kg-m3");

    filtration_curve *c = take(all.n * sizeof *c);
    filtration_estimate clean = {NAN, NAN, NAN, NAN};
    size_t shown = 0; /* the run whose pressure is nearest to the prediction's */
    const bool elsewhere = s.new_pressure != s.def.pressure;
    for (size_t i = 0; i < all.n; i++) {
        const readings *r = &all.run[i];
        if (s.cake_height > 0.0)
            s.def.cake_ratio = filtration_cake_ratio_of_height(s.cake_height, s.def.area, r->volume[r->n - 1]);
        c[i] = evaluate(&self, &s, r, &clean);
        if (elsewhere && fabs(log(r->pressure / s.new_pressure)) < fabs(log(all.run[shown].pressure / s.new_pressure)))
            shown = i;
    }
    const readings *r = &all.run[shown];
    s.def.pressure = r->pressure;
    if (!elsewhere) s.new_pressure = r->pressure;
    if (!(s.new_volume > 0.0)) s.new_volume = 2.0 * r->volume[r->n - 1] * s.new_area / s.def.area;
    if (s.clean_volume > 0.0 && shown + 1 < all.n) c[shown] = evaluate(&self, &s, r, &clean);
    json *report = json_open(self.json);
    if (all.n > 1) {
        const double exponent = fit_law(&self, report, &s, t.reference, &all, c);
        if (!is_given(&self, "compressibility")) s.compressibility = exponent;
        common_print("\nRun %zu:\n", shown + 1);
    }
    common_print("Filter curve: %s, %zu readings; %.4g Pa, %.4g cm2, %.4g Pa s\n",
                 data ? data : "drawn from the paper's numbers", r->n, s.def.pressure, 1e4 * s.def.area,
                 s.def.viscosity);
    tell_curve(report, &s, r, &c[shown], &clean);
    draw_curve(&self, &s, r, &c[shown]);
    if (c[shown].slope.value > 0.0 || c[shown].intercept.value > 0.0) predict(&self, report, &s, &c[shown]);
    for (size_t i = 0; i < all.n; i++) free(all.run[i].time);
    free(all.run);
    free(c);
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
