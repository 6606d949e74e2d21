/* screen_lab.h: a screen of one's own. Reads test curves of any screen and a sieve curve from CSV files, writes and
   reads fitted parameters.

   Curves, one row a reading (data/screen_template.csv):
     case       a name or number
     time       [s] (or _s, _min)
     size       mean size of the class [m] (or _mm, _um)
     retained   mass still on the deck over initial mass of the class [-] (or _percent)
     amplitude  half the stroke [m] (or _mm)        frequency  [Hz] (or _rpm)
     aperture   clear width [m] (or _mm)
   and where known: moisture [-] (or _percent), wire [m], inclination [rad] (or _deg), load [kg/m2], share (of the class
   in what can pass), oversize (share of the feed that cannot pass). Rows of a case may stand in any order; the same
   reading twice is averaged.
   Other words and units: sheet.h. */
#ifndef SCREEN_LAB_H
#define SCREEN_LAB_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "screen_models.h"

enum { LAB_CASES = 400, LAB_MODELS = 4 };
static const char *const lab_keys[LAB_MODELS] = {"first_order", "dong", "subasinghe", "soldinger"};
static const char *const lab_names[LAB_MODELS] = {"0 first order", "1 Dong", "2 Subasinghe", "3 Soldinger"};

typedef struct lab {
    int cases, skipped; /* skipped: readings of classes that cannot pass */
    bool load_known, wire_known;
    char label[LAB_CASES][40];
    screen_def decks[LAB_CASES];
    screen_case data[LAB_CASES];
    double *memory; /* of all arrays */
} lab;

static inline void lab_refuse(const program *self, const char *option_name, const char *path, const char *reason) {
    program_refuse(self, option_name, path, reason);
}

static inline int lab_ascending(const void *a, const void *b) {
    return (*(const double *)a > *(const double *)b) - (*(const double *)a < *(const double *)b);
}

static inline int lab_unique(double *x, int n) {
    int kept = 0;
    qsort(x, (size_t)n, sizeof *x, lab_ascending);
    for (int i = 0; i < n; i++)
        if (kept == 0 || x[i] != x[kept - 1]) x[kept++] = x[i];
    return kept;
}

enum {
    LAB_CASE,
    LAB_TIME,
    LAB_SIZE,
    LAB_RETAINED,
    LAB_AMPLITUDE,
    LAB_FREQUENCY,
    LAB_APERTURE,
    LAB_MOISTURE,
    LAB_WIRE,
    LAB_INCLINATION,
    LAB_LOAD,
    LAB_SHARE,
    LAB_OVERSIZE,
    LAB_COLUMNS
};

/* What a reading has; the first LAB_NEEDED must be there. */
static inline void lab_name_columns(sheet_column *column) {
    const sheet_column columns[LAB_COLUMNS] = {
        sheet_want("case", 't', true),         sheet_want("time", 'T', true),      sheet_want("size", 'L', true),
        sheet_want("retained", '%', true),     sheet_want("amplitude", 'L', true), sheet_want("frequency", 'f', true),
        sheet_want("aperture", 'L', true),     sheet_want("moisture", 's', false), sheet_want("wire", 'L', false),
        sheet_want("inclination", 'W', false), sheet_want("load", 'a', false),     sheet_want("share", '%', false),
        sheet_want("oversize", 's', false)};
    memcpy(column, columns, sizeof columns);
}

/* NaN for an empty cell. */
static inline double lab_value(const sheet_column *column, int row, double otherwise) {
    return column->value ? column->value[row] : otherwise;
}

/* The rows of one case into room [3 + its rows ...]; returns what is used of it. */
static inline double *lab_read_case(const program *self, const char *path, const sheet_column *column, const int *rows,
                                    int n, lab *out, double *room) {
    const int k = out->cases - 1;
    char reason[300];
    double value[LAB_COLUMNS];
    const double otherwise[LAB_COLUMNS] = {0, NAN, NAN, NAN, NAN, NAN, NAN, 0.0, NAN, 0.0, 50.0, NAN, 1.0 / 3.0};
    for (int j = LAB_TIME; j < LAB_COLUMNS; j++) value[j] = lab_value(&column[j], rows[0], otherwise[j]);
    double *time = room, *size, *share, *retained, *count;
    int times = 0, classes = 0;
    for (int i = 0; i < n; i++) {
        for (int j = LAB_TIME; j < LAB_COLUMNS; j++) {
            double x = lab_value(&column[j], rows[i], otherwise[j]);
            if (column[j].index >= 0 && !isfinite(x)) {
                snprintf(reason, sizeof reason, "numbers in every column; case %s, reading %d: %s is none",
                         out->label[k], i + 1, column[j].name);
                lab_refuse(self, "data", path, reason);
            }
            if (j > LAB_RETAINED && j != LAB_SHARE && column[j].index >= 0 && x != value[j]) {
                snprintf(reason, sizeof reason, "one %s a case; case %s has several", column[j].name, out->label[k]);
                lab_refuse(self, "data", path, reason);
            }
        }
        time[times++] = lab_value(&column[LAB_TIME], rows[i], NAN);
    }
    times = lab_unique(time, times);
    size = time + times;
    for (int i = 0; i < n; i++) {
        double d = lab_value(&column[LAB_SIZE], rows[i], NAN);
        if (d < value[LAB_APERTURE]) size[classes++] = d;
        else out->skipped++;
    }
    classes = lab_unique(size, classes);
    if (classes == 0) {
        snprintf(reason, sizeof reason, "classes smaller than the aperture; case %s has none", out->label[k]);
        lab_refuse(self, "data", path, reason);
    }
    if ((long)classes * times > n) { /* also what bounds the memory */
        snprintf(reason, sizeof reason,
                 "a reading of every class at every time; case %s has %d readings for %d classes and %d times",
                 out->label[k], n, classes, times);
        lab_refuse(self, "data", path, reason);
    }
    share = size + classes;
    retained = share + classes;
    count = retained + (size_t)classes * (size_t)times; /* scratch */
    for (int i = 0; i < classes * times; i++) retained[i] = count[i] = 0.0;
    for (int i = 0; i < classes; i++) share[i] = 1.0 / classes;
    for (int i = 0; i < n; i++) {
        double d = lab_value(&column[LAB_SIZE], rows[i], NAN), t = lab_value(&column[LAB_TIME], rows[i], NAN);
        for (int c = 0; c < classes; c++)
            for (int j = 0; j < times; j++)
                if (size[c] == d && time[j] == t) {
                    retained[c * times + j] += lab_value(&column[LAB_RETAINED], rows[i], NAN);
                    count[c * times + j] += 1.0;
                    if (column[LAB_SHARE].index >= 0) share[c] = lab_value(&column[LAB_SHARE], rows[i], NAN);
                }
    }
    double all = 0.0;
    for (int c = 0; c < classes; c++) all += share[c];
    for (int c = 0; c < classes; c++) share[c] /= all;
    for (int i = 0; i < classes * times; i++) {
        if (count[i] == 0.0) {
            snprintf(reason, sizeof reason, "a reading of every class at every time; case %s has none of %g mm at %g s",
                     out->label[k], 1e3 * size[i / times], time[i % times]);
            lab_refuse(self, "data", path, reason);
        }
        retained[i] /= count[i];
    }
    screen_def *deck = &out->decks[k];
    *deck = screen_default_def();
    deck->aperture = value[LAB_APERTURE];
    deck->wire = column[LAB_WIRE].index >= 0 ? value[LAB_WIRE] : 0.25 * deck->aperture;
    deck->classes = classes;
    deck->diameters = size;
    deck->shares = share;
    deck->deck_area = 1.0;
    deck->undersize_mass = value[LAB_LOAD] * (1.0 - value[LAB_OVERSIZE]);
    deck->oversize_mass = value[LAB_LOAD] * value[LAB_OVERSIZE];
    deck->coarse_diameter = 1.25 * deck->aperture;
    screen_case *one = &out->data[k];
    one->operation.amplitude = value[LAB_AMPLITUDE];
    one->operation.frequency = value[LAB_FREQUENCY];
    one->operation.moisture = value[LAB_MOISTURE];
    one->operation.inclination = value[LAB_INCLINATION];
    one->times = times;
    one->time = time;
    one->retained = retained;
    const char *field;
    if (screen_check_def(deck, &field) || screen_check_operation(&one->operation)) {
        screen_status status = screen_check_operation(&one->operation);
        snprintf(reason, sizeof reason, "case %s: %s", out->label[k], status ? screen_status_text(status) : field);
        lab_refuse(self, "data", path, reason);
    }
    return count;
}

/* Leaves with 2 and one line where the file is no good. */
static inline void lab_read(const program *self, const char *path, lab *out) {
    sheet data;
    char message[600];
    sheet_column column[LAB_COLUMNS];
    lab_name_columns(column);
    if (sheet_read(path, column, LAB_COLUMNS, &data, message, (int)sizeof message))
        lab_refuse(self, "data", path, message);
    common_print("%s\n", data.how);
    out->cases = out->skipped = 0;
    out->load_known = column[LAB_LOAD].index >= 0;
    out->wire_known = column[LAB_WIRE].index >= 0;
    const size_t most = 8 * (size_t)(data.rows + 1);
    if (data.rows > 20000) lab_refuse(self, "data", path, "a file with at most 20000 readings");
    int *rows = malloc((size_t)(data.rows + 1) * sizeof *rows);
    char *done = calloc((size_t)data.rows + 1, 1);
    double *room = out->memory = malloc(most * sizeof *room);
    if (!rows || !done || !room) {
        common_fail("out of memory");
        exit(1);
    }
    for (int first = 0; first < data.rows; first++) {
        if (done[first]) continue;
        const char *label = data.cell[first * data.columns + column[LAB_CASE].index];
        int n = 0;
        for (int i = first; i < data.rows; i++)
            if (strcmp(data.cell[i * data.columns + column[LAB_CASE].index], label) == 0) {
                rows[n++] = i;
                done[i] = 1;
            }
        if (out->cases == LAB_CASES) lab_refuse(self, "data", path, "a file with at most 400 cases");
        snprintf(out->label[out->cases++], sizeof out->label[0], "%s", label);
        room = lab_read_case(self, path, column, rows, n, out, room);
    }
    free(rows);
    free(done);
    sheet_free(&data);
    if (out->cases == 0) lab_refuse(self, "data", path, "a file with readings");
    /* one mass unit for the grains of all cases: that of a grain as large as the widest aperture, so that no
       probability exceeds 1 */
    double widest = 0.0;
    for (int k = 0; k < out->cases; k++) widest = fmax(widest, out->decks[k].aperture);
    for (int k = 0; k < out->cases; k++)
        out->decks[k].ratio_mass = screen_grain_ratio(out->decks[k].density, widest, 1.0);
}

/* ---- parameters ---- */

static inline void lab_write_fit(json *report, const screen_fit_result *fit, int model) {
    json_object_begin(report, lab_keys[model]);
    results_values(report, {"deviation", fit->deviation}, {"rms", fit->rms}, {"case_error", fit->case_error},
                   {"degrees_of_freedom", fit->dof});
    const double *const numbers[4] = {fit->parameter, fit->low, fit->high, fit->error};
    static const char *const titles[4] = {"value", "low95", "high95", "standard_error"};
    for (int t = 0; t < 4; t++) {
        json_object_begin(report, titles[t]);
        for (int j = 0; j < fit->parameters; j++)
            json_number(report, screen_parameter_name((screen_model)model, j), numbers[t][j]);
        json_object_end(report);
    }
    json_array_begin(report, "not_determined");
    for (int j = 0; j < fit->parameters; j++)
        if (!fit->determined[j]) json_string(report, NULL, screen_parameter_name((screen_model)model, j));
    json_array_end(report);
    const screen_domain *d = &fit->domain;
    const double domain[18] = {d->amplitude[0], d->amplitude[1],   d->frequency[0],   d->frequency[1], d->moisture[0],
                               d->moisture[1],  d->inclination[0], d->inclination[1], d->diameter[0],  d->diameter[1],
                               d->aperture[0],  d->aperture[1],    d->load[0],        d->load[1],      d->time[0],
                               d->time[1],      d->classes[0],     d->classes[1]};
    json_array(report, "domain_amplitude_frequency_moisture_inclination_diameter_aperture_load_time_classes", domain,
               18);
    json_string(report, "ratio", fit->ratio == SCREEN_RATIO_GRAIN ? "grain" : "retained");
    json_number(report, "ratio_mass_kg", fit->ratio_mass);
    json_array(report, "parameter", fit->parameter, fit->parameters);
    json_array(report, "coefficient", fit->coefficient, fit->parameters);
    json_array(report, "centre", fit->centre, 4);
    json_array(report, "factor", &fit->factor[0][0], SCREEN_MAX_PARAMETERS * SCREEN_MAX_PARAMETERS);
    json_object_end(report);
}

/* n numbers after "key": from a place in a JSON text; NaN for null. 0, or -1 where they are not there. */
static inline int lab_numbers(const char *text, const char *key, double *out, int n) {
    char name[120];
    snprintf(name, sizeof name, "\"%s\"", key);
    const char *at = text ? strstr(text, name) : NULL;
    if (!at) return -1;
    at += strlen(name);
    for (int i = 0; i < n; i++) {
        while (*at && strchr(" \t\r\n:[,", *at)) at++;
        char *end;
        out[i] = strtod(at, &end);
        if (strncmp(at, "null", 4) == 0) {
            out[i] = NAN;
            end = (char *)(size_t)at + 4;
        }
        if (end == at) return -1;
        at = end;
    }
    return 0;
}

/* The fits of a file that screen_fit wrote, for screen_predict and screen_fit_band. Leaves with 2 where it is none. */
static inline void lab_read_fits(const program *self, const char *path, screen_fit_result *fits) {
    static char text[200000];
    FILE *file = fopen(path, "rb");
    size_t n = file ? fread(text, 1, sizeof text - 1, file) : 0;
    if (file) fclose(file);
    text[n] = '\0';
    for (int m = 0; m < LAB_MODELS; m++) {
        screen_fit_result *fit = &fits[m];
        char name[40];
        double domain[18], mass[1], errors[3];
        snprintf(name, sizeof name, "\"%s\":", lab_keys[m]);
        const char *at = strstr(text, name);
        memset(fit, 0, sizeof *fit);
        fit->model = (screen_model)m;
        fit->parameters = screen_parameter_count(fit->model, 0);
        if (lab_numbers(at, "parameter", fit->parameter, fit->parameters) ||
            lab_numbers(at, "coefficient", fit->coefficient, fit->parameters) ||
            lab_numbers(at, "centre", fit->centre, 4) ||
            lab_numbers(at, "factor", &fit->factor[0][0], SCREEN_MAX_PARAMETERS * SCREEN_MAX_PARAMETERS) ||
            lab_numbers(at, "domain_amplitude_frequency_moisture_inclination_diameter_aperture_load_time_classes",
                        domain, 18) ||
            lab_numbers(at, "ratio_mass_kg", mass, 1) || lab_numbers(at, "deviation", &errors[0], 1) ||
            lab_numbers(at, "case_error", &errors[1], 1))
            program_refuse(self, "parameters", path, "a file parameters.json that screen_fit --data has written");
        double *const ranges[8] = {fit->domain.amplitude,   fit->domain.frequency, fit->domain.moisture,
                                   fit->domain.inclination, fit->domain.diameter,  fit->domain.aperture,
                                   fit->domain.load,        fit->domain.time};
        for (int i = 0; i < 16; i++) ranges[i / 2][i % 2] = domain[i];
        fit->domain.classes[0] = (int)domain[16];
        fit->domain.classes[1] = (int)domain[17];
        fit->ratio = SCREEN_RATIO_GRAIN;
        fit->ratio_mass = mass[0];
        fit->deviation = errors[0];
        fit->case_error = errors[1];
    }
}

/* What of a prediction is extrapolated, as words: "aperture, load ..."; "" for nothing. */
static inline const char *lab_outside(char *text, size_t size, unsigned flags) {
    size_t n = 0;
    text[0] = '\0';
    for (unsigned flag = 1; flag <= SCREEN_OUTSIDE_TIME; flag *= 2)
        if (flags & flag && n < size)
            n += (size_t)snprintf(text + n, size - n, "%s%s", n ? ", " : "", screen_outside_text(flag));
    return text;
}

#endif
