#include "results.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"

enum { COLUMNS_MAX = 40, NAME_SIZE = 64 };

typedef struct cell {
    double number;
    char *text; /* NULL: there is none */
} cell;

struct result_table {
    result_column column[COLUMNS_MAX];
    char json[COLUMNS_MAX][NAME_SIZE], csv[COLUMNS_MAX][NAME_SIZE]; /* names; empty: not there */
    cell *cells;                                                    /* [rows][n] */
    double **taken;                                                 /* columns that were asked for */
    int n, rows, n_taken;
};

const char results_end[1];

static void *sized(void *old, size_t size) {
    void *memory = realloc(old, size ? size : 1);
    if (memory) return memory;
    common_fail("results: out of memory");
    exit(1);
}

static bool is_text(const result_column *c) { return c->format && strcmp(c->format, "%s") == 0; }

static void add_column(result_table *r, const result_column *c, const char *key, size_t length) {
    const char *bar = memchr(key, '|', length), *end = key + length, *csv = bar ? bar + 1 : key + (*key == '?');
    if (r->n == COLUMNS_MAX) abort();
    snprintf(r->json[r->n], NAME_SIZE, "%.*s", (int)((bar ? bar : end) - key), key);
    snprintf(r->csv[r->n], NAME_SIZE, "%.*s", (int)(end - csv), csv);
    r->column[r->n++] = *c;
}

result_table *results_new(const result_column *columns, int n) {
    result_table *r = memset(sized(NULL, sizeof *r), 0, sizeof *r);
    for (int k = 0; k < n; k++) {
        const char *key = columns[k].key ? columns[k].key : "";
        add_column(r, &columns[k], key, strlen(key));
    }
    return r;
}

result_table *results_of(const char *header) {
    static const result_column number;
    result_table *r = results_new(NULL, 0);
    for (size_t length; *header; header += length + (header[length] == ','))
        add_column(r, &number, header, length = strcspn(header, ","));
    return r;
}

void results_free(result_table *r) {
    if (!r) return;
    for (int k = 0; k < r->rows * r->n; k++) free(r->cells[k].text);
    for (int k = 0; k < r->n_taken; k++) free(r->taken[k]);
    free(r->taken), free(r->cells), free(r);
}

/* Another number of cells than the columns need is a fault of the program, as an index out of range is. */
void results_add(result_table *r, const char *const *texts, const double *numbers, int n) {
    int used = 0;
    if ((r->rows & (r->rows - 1)) == 0)
        r->cells = sized(r->cells, (size_t)(2 * r->rows + 1) * (size_t)r->n * sizeof *r->cells);
    for (int k = 0; k < r->n; k++) {
        cell *to = &r->cells[r->rows * r->n + k];
        to->text = NULL, to->number = (double)NAN;
        if (is_text(&r->column[k]) ? !texts || *texts == results_end : used == n) abort();
        if (is_text(&r->column[k]) && *texts++) to->text = strcpy(sized(NULL, strlen(texts[-1]) + 1), texts[-1]);
        else if (!is_text(&r->column[k])) to->number = numbers[used++];
    }
    if (used < n || (texts && *texts != results_end)) abort();
    r->rows++;
}

int results_rows(const result_table *r) { return r->rows; }

const double *results_column(result_table *r, const char *key, double scale) {
    int k = 0;
    while (k < r->n && strcmp(r->json[k], key) != 0 && strcmp(r->csv[k], key) != 0) k++;
    if (k == r->n) abort();
    double *values = sized(NULL, (size_t)r->rows * sizeof *values);
    for (int row = 0; row < r->rows; row++) values[row] = scale * r->cells[row * r->n + k].number;
    r->taken = sized(r->taken, (size_t)(r->n_taken + 1) * sizeof *r->taken);
    return r->taken[r->n_taken++] = values;
}

/* ---- writing ---- */

static const char *shown(char *text, size_t size, const char *format, double scale, double value) {
    const int length = (int)strcspn(format, "|");
    if (isnan(value)) return "-";
    if (strchr(format, '%')) snprintf(text, size, format, scale == 0.0 ? value : scale * value);
    else snprintf(text, size, "%.*s", value != 0.0 ? length : (int)size, value != 0.0 ? format : format + length + 1);
    return text;
}

void results_print(const result_table *r) {
    char text[400], header[2000] = "";
    for (int k = 0; k < r->n; k++) {
        const size_t used = strlen(header);
        if (r->column[k].heading)
            snprintf(header + used, sizeof header - used, "%s%s", used ? "|" : "", r->column[k].heading);
    }
    riddle_io_table t = riddle_io_table_begin(header);
    for (int k = 0; k < r->rows * r->n; k++) {
        const result_column *c = &r->column[k % r->n];
        const cell *x = &r->cells[k];
        if (c->heading)
            riddle_io_table_cell(&t, "%s",
                                 x->text ? x->text : shown(text, sizeof text, c->format, c->scale, x->number));
    }
    table_end(&t);
}

/* A text in quotes where it has a comma; a number in the fewest digits from which it is read back as it is. */
static void csv_cell(riddle_io_file *file, const char *text, double number) {
    char digits[40] = "";
    const char *quote = text && strchr(text, ',') ? "\"" : "";
    for (int n = 15; !text && isfinite(number) && n <= 17; n++) {
        snprintf(digits, sizeof digits, "%.*g", n, number);
        if (strtod(digits, NULL) == number) break;
    }
    riddle_io_print(file, "%s%s%s", quote, text ? text : digits, quote);
}

void results_csv(const result_table *r, const char *folder, const char *name) {
    riddle_io_file *file = riddle_io_open(folder, name);
    for (int row = -1; row < r->rows; row++) {
        const char *comma = "";
        for (int k = 0; k < r->n; k++) {
            const cell *x = &r->cells[row < 0 ? 0 : row * r->n + k];
            if (!*r->csv[k]) continue;
            riddle_io_print(file, "%s", comma);
            csv_cell(file, row < 0 ? r->csv[k] : x->text, row < 0 ? 0.0 : x->number);
            comma = ",";
        }
        riddle_io_print(file, "\n");
    }
    riddle_io_close(file);
}

void results_json(const result_table *r, json *report, const char *key) {
    if (key) json_array_begin(report, key);
    for (int row = 0; row < r->rows; row++) {
        json_object_begin(report, NULL);
        for (int k = 0; k < r->n; k++) {
            const char *name = r->json[k], *format = r->column[k].format;
            const cell *x = &r->cells[row * r->n + k];
            const bool may_lack = *name == '?';
            if (!*name || (may_lack && !x->text && isnan(x->number))) continue;
            name += may_lack;
            if (is_text(&r->column[k])) json_string(report, name, x->text);
            else if (format && !strchr(format, '%') && !isnan(x->number)) json_bool(report, name, x->number != 0.0);
            else json_number(report, name, x->number);
        }
        json_object_end(report);
    }
    if (key) json_array_end(report);
}

void results_write(const result_table *r, json *report, const char *key, const char *folder, const char *name) {
    results_print(r);
    results_csv(r, folder, name);
    results_json(r, report, key);
}

void results_say(json *report, const result_value *values, int n) {
    char text[100];
    int width = 0;
    for (int k = 0; k < n; k++)
        if (values[k].heading && (int)strlen(values[k].heading) > width) width = (int)strlen(values[k].heading);
    for (int k = 0; k < n; k++) {
        const result_value *v = &values[k];
        if (v->key) json_number(report, v->key, v->value);
        if (v->heading)
            common_print("%-*s  %s\n", width, v->heading, shown(text, sizeof text, v->format, v->scale, v->value));
    }
}
