#define _POSIX_C_SOURCE 200809L
#include "csv.h"
#include "input.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

static bool to_number(const char *cell, double *value) {
    char *end;
    if (!*cell) {
        *value = (double)NAN;
        return true;
    }
    if (strpbrk(cell, "xXpP")) return false; /* no hexadecimal */
    *value = strtod(cell, &end);
    return *end == '\0';
}

/* Cuts a line (ended by 0) at its commas into cells without blanks and quotes around; returns how many. */
static int cut(char *line, char **cells) {
    int n = 0;
    for (char *at = line;; n++) {
        char *end;
        while (is_blank(*at)) at++;
        if (*at == '"' && (end = strchr(at + 1, '"')) != NULL) {
            cells[n] = at + 1;
            *end++ = '\0';
            end += strcspn(end, ",");
        } else {
            cells[n] = at;
            end = at + strcspn(at, ",");
            for (char *last = end; last > at && is_blank(last[-1]); last--) last[-1] = '\0';
        }
        if (!*end) return n + 1;
        *end = '\0';
        at = end + 1;
    }
}

static int refuse(csv_data *data, char *message, int size, const char *format, ...) COMMON_PRINTF(4, 5);
static int refuse(csv_data *data, char *message, int size, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, (size_t)size, format, arguments);
    va_end(arguments);
    for (char *c = message; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127) *c = '?';
    csv_free(data);
    return -1;
}

int csv_parse(const char *text, long size, const char *path, csv_data *data, char *message, int message_size) {
    static const csv_data empty;
    *data = empty;
    if (size < 0 || (size > 0 && memchr(text, '\0', (size_t)size))) return refuse(data, message, message_size, "%s: not a text file", path);
    long lines = 1, commas = 0, widest = 0, here = 0;
    for (long i = 0; i < size; i++) {
        if (text[i] == ',') here++;
        if (here > widest) widest = here;
        if (text[i] == '\n') {
            lines++;
            here = 0;
        }
        commas += text[i] == ',';
    }
    if (lines > INT_MAX / 2 || commas > INT_MAX / 2) return refuse(data, message, message_size, "%s: too long", path);
    /* every line may be a row of as many cells as it has commas; the rows must agree with the header */
    data->memory = malloc((size_t)size + 1);
    data->names = malloc((size_t)(widest + 1) * sizeof *data->names);
    data->cells = malloc((size_t)(commas + lines + widest + 1) * sizeof *data->cells);
    data->values = malloc((size_t)(commas + lines) * sizeof *data->values);
    if (!data->memory || !data->names || !data->cells || !data->values)
        return refuse(data, message, message_size, "%s: out of memory", path);
    if (size > 0) memcpy(data->memory, text, (size_t)size);
    data->memory[size] = '\0';

    int number = 0;
    bool *is_text = NULL;
    for (char *line = data->memory, *next; line; line = next) {
        next = strchr(line, '\n');
        if (next) *next++ = '\0';
        number++;
        while (is_blank(*line)) line++;
        if (!*line || *line == '#') continue;
        if (!data->columns) {
            char *comment = strstr(line, " #");
            if (comment) *comment = '\0';
            data->columns = cut(line, data->names);
            is_text = calloc((size_t)data->columns * 2, sizeof *is_text); /* [columns] it is text, [columns] it is known */
            if (!is_text) return refuse(data, message, message_size, "%s: out of memory", path);
            continue;
        }
        char **row = data->cells + (size_t)data->rows * (size_t)data->columns;
        int n = cut(line, row);
        if (n != data->columns) {
            free(is_text);
            return refuse(data, message, message_size, "%s:%d: %d cells, but the header names %d", path, number, n, data->columns);
        }
        for (int k = 0; k < n; k++) {
            double *value = &data->values[(size_t)data->rows * (size_t)n + (size_t)k];
            bool fine = to_number(row[k], value);
            if (*row[k] && !is_text[n + k]) {
                is_text[n + k] = true;
                is_text[k] = !fine;
            }
            if (is_text[k]) *value = (double)NAN;
            else if (!fine) {
                free(is_text);
                return refuse(data, message, message_size, "%s:%d: column %.60s: '%.60s' is not a number", path, number, data->names[k],
                              row[k]);
            }
        }
        data->rows++;
    }
    free(is_text);
    if (!data->columns) return refuse(data, message, message_size, "%s: no header line", path);
    return 0;
}

int csv_read(const char *path, csv_data *data, char *message, int message_size) {
    static const csv_data empty;
    *data = empty;
    size_t size;
    char *text = input_read(path, &size, message, (size_t)message_size);
    if (!text) return -1;
    int status = csv_parse(text, (long)size, path, data, message, message_size);
    free(text);
    return status;
}

int csv_column(const csv_data *data, const char *name) {
    for (int k = 0; k < data->columns; k++)
        if (strcmp(data->names[k], name) == 0) return k;
    return -1;
}

double csv_value(const csv_data *data, int row, const char *name) {
    int k = csv_column(data, name);
    if (k < 0 || row < 0 || row >= data->rows) return (double)NAN;
    return data->values[(size_t)row * (size_t)data->columns + (size_t)k];
}

void csv_free(csv_data *data) {
    static const csv_data empty;
    free(data->memory);
    free(data->names);
    free(data->cells);
    free(data->values);
    *data = empty;
}
