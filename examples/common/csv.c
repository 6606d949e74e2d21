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

#define RIDDLE_DEG 0.017453292519943295

static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* Reads a cell. decimal: what stands before the decimals, besides a point. */
static bool to_number(const char *cell, char decimal, double *value) {
    char text[64], *end;
    const char *comma = decimal == ',' ? strchr(cell, ',') : NULL;
    if (!*cell) {
        *value = (double)NAN;
        return true;
    }
    if (strpbrk(cell, "xXpP")) return false; /* no hexadecimal */
    if (comma) {
        if (strchr(cell, '.') || strchr(comma + 1, ',') || strlen(cell) >= sizeof text) return false;
        strcpy(text, cell);
        text[comma - cell] = '.';
        cell = text;
    }
    *value = strtod(cell, &end);
    return *end == '\0';
}

/* Returns whether a number is one to three digits, not 0 first, a mark, and three digits: 1.250 may be 1250. */
static bool may_be_thousands(const char *cell) {
    cell += *cell == '-' || *cell == '+';
    const size_t first = strspn(cell, "0123456789");
    if (first < 1 || first > 3 || *cell == '0' || (cell[first] != '.' && cell[first] != ',')) return false;
    return strspn(cell + first + 1, "0123456789") == 3 && cell[first + 4] == '\0';
}

size_t csv_quoted(const char *cell, const char *stops) {
    const char *close = cell + 1, *next;
    if (*cell != '"') return 0;
    while ((close = strchr(close, '"')) != NULL && close[1] == '"') close += 2;
    if (!close) return 0;
    for (next = close + 1; is_blank(*next) && !strchr(stops, *next);) next++;
    return !*next || strchr(stops, *next) ? (size_t)(close - cell) : 0;
}

/* Two quotes in a quoted cell are one of its text. */
static void undo_doubled(char *cell) {
    char *to = cell;
    for (const char *from = cell; *from; from++) {
        *to++ = *from;
        if (from[0] == '"' && from[1] == '"') from++;
    }
    *to = '\0';
}

/* Where the quotes around a cell that begins at `at` end, from there on; else 0. A quote within a cell, as in 3/4",
   begins none. */
static size_t quoted_from(const char *at, const char *line, const char *stops) {
    const char *before = at;
    if (*at != '"') return 0;
    while (before > line && is_blank(before[-1]) && !strchr(stops, before[-1])) before--;
    return before == line || strchr(stops, before[-1]) ? csv_quoted(at, stops) : 0;
}

int csv_cut(char *line, char separator, char **cells) {
    const char stop[2] = {separator, '\0'};
    int n = 0;
    for (char *at = line;; n++) {
        char *end;
        while (is_blank(*at) && *at != separator) at++;
        const size_t quoted = csv_quoted(at, stop);
        if (quoted > 0) {
            cells[n] = at + 1;
            end = at + quoted;
            *end++ = '\0';
            end += strcspn(end, stop);
            undo_doubled(cells[n]);
        } else {
            cells[n] = at;
            end = at + strcspn(at, stop);
            for (char *last = end; last > at && is_blank(last[-1]); last--) last[-1] = '\0';
        }
        if (!*end) return n + 1;
        *end = '\0';
        at = end + 1;
    }
}

/* What separates the cells: the first semicolon or tab of the line of names outside quotes, else commas. */
static char separator_of(const char *line) {
    for (const char *c = line; *c; c++) {
        c += quoted_from(c, line, ",;\t");
        if (*c == ';' || *c == '\t') return *c;
    }
    return ',';
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

/* Makes room for every cell that the text can have. */
static bool make_room(const char *text, long size, csv_data *data) {
    long lines = 1, cuts = 0, widest = 0, here = 0;
    for (long i = 0; i < size; i++) {
        const bool is_cut = text[i] == ',' || text[i] == ';' || text[i] == '\t';
        here += is_cut;
        cuts += is_cut;
        if (here > widest) widest = here;
        if (text[i] == '\n' || text[i] == '\r') lines++, here = 0;
    }
    if (lines > INT_MAX / 2 || cuts > INT_MAX / 2) return false;
    /* every line may be a row of as many cells as it has cuts; the rows must agree with the header */
    data->memory = malloc((size_t)size + 1);
    data->names = malloc((size_t)(widest + 1) * sizeof *data->names);
    data->cells = malloc((size_t)(cuts + lines + widest + 1) * sizeof *data->cells);
    data->values = malloc((size_t)(cuts + lines) * sizeof *data->values);
    data->lines = malloc((size_t)lines * sizeof *data->lines);
    /* [columns] it is text, [columns] it is known */
    data->is_text = calloc((size_t)(widest + 1) * 2, sizeof *data->is_text);
    return data->memory && data->names && data->cells && data->values && data->lines && data->is_text;
}

/* Ends the line at `line` and returns the next one, or NULL. */
static char *end_line(char *line) {
    char *end = line + strcspn(line, "\r\n");
    if (!*end) return NULL;
    const bool both = end[0] == '\r' && end[1] == '\n';
    *end = '\0';
    return end + (both ? 2 : 1);
}

/* Refuses a number in a table that has decimal points as well as decimal commas, if one of them may
   separate thousands. */
static int check_decimals(csv_data *data, const char *path, char *message, int message_size) {
    bool point = false, comma = false;
    int doubtful = -1;
    for (int k = 0; k < data->rows * data->columns; k++) {
        if (data->is_text[k % data->columns]) continue;
        point |= strchr(data->cells[k], '.') != NULL, comma |= strchr(data->cells[k], ',') != NULL;
        if (doubtful < 0 && may_be_thousands(data->cells[k])) doubtful = k;
    }
    if (!point || !comma || doubtful < 0) return 0;
    return refuse(data, message, message_size,
                  "%s:%d: column %.60s: '%.60s' may be in thousands: other numbers have %s", path,
                  data->lines[doubtful / data->columns], data->names[doubtful % data->columns], data->cells[doubtful],
                  strchr(data->cells[doubtful], '.') ? "decimal commas" : "decimal points");
}

/* Takes off a comment that follows the last cell of a row, if that cell is a number: text may have a '#'. */
static void cut_comment(const csv_data *data, char *line, char separator) {
    const int last = data->columns - 1;
    const char *cell = line, stop[2] = {separator, '\0'};
    int cuts = 0;
    for (char *c = line; *c; c++) {
        c += quoted_from(c, line, stop);
        if (*c == separator) cuts++, cell = c + 1;
        if (*c != '#' || c == cell || !is_blank(c[-1])) continue;
        char text[64];
        double value;
        while (is_blank(*cell)) cell++;
        size_t length = (size_t)(c - cell);
        while (length > 0 && is_blank(cell[length - 1])) length--;
        if (cuts != last || length == 0 || length >= sizeof text ||
            (data->is_text[data->columns + last] && data->is_text[last]))
            return;
        memcpy(text, cell, length);
        text[length] = '\0';
        if (to_number(text, separator == ',' ? '.' : ',', &value)) *c = '\0';
        return;
    }
}

static int take_row(csv_data *data, char *line, char separator, int number, const char *path, char *message,
                    int message_size) {
    const int columns = data->columns;
    char **row = data->cells + (size_t)data->rows * (size_t)columns;
    cut_comment(data, line, separator);
    const int n = csv_cut(line, separator, row);
    if (n != columns)
        return refuse(data, message, message_size, "%s:%d: %d cells, but the header names %d", path, number, n,
                      columns);
    for (int k = 0; k < n; k++) {
        double *value = &data->values[(size_t)data->rows * (size_t)n + (size_t)k];
        const bool fine = to_number(row[k], separator == ',' ? '.' : ',', value);
        if (*row[k] && !data->is_text[columns + k]) {
            data->is_text[columns + k] = 1;
            data->is_text[k] = !fine;
        }
        if (data->is_text[k]) *value = (double)NAN;
        else if (!fine)
            return refuse(data, message, message_size, "%s:%d: column %.60s: '%.60s' is not a number", path, number,
                          data->names[k], row[k]);
    }
    data->lines[data->rows++] = number;
    return 0;
}

int csv_parse(const char *text, long size, const char *path, csv_data *data, char *message, int message_size) {
    static const csv_data empty;
    char separator = ',';
    int number = 0;
    *data = empty;
    if (size < 0 || (size > 0 && memchr(text, '\0', (size_t)size)))
        return refuse(data, message, message_size, "%s: not a text file", path);
    if (size >= 2 && (memcmp(text, "\xff\xfe", 2) == 0 || memcmp(text, "\xfe\xff", 2) == 0))
        return refuse(data, message, message_size, "%s: not a text file in UTF-8", path);
    if (size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) text += 3, size -= 3; /* a byte-order mark */
    if (!make_room(text, size, data))
        return refuse(data, message, message_size, "%s: too long, or out of memory", path);
    if (size > 0) memcpy(data->memory, text, (size_t)size);
    data->memory[size] = '\0';
    for (char *line = data->memory, *next; line; line = next) {
        next = end_line(line);
        number++;
        while (is_blank(*line) && *line != separator) line++;
        if (!*line || *line == '#') continue;
        if (data->columns) {
            if (take_row(data, line, separator, number, path, message, message_size) != 0) return -1;
            continue;
        }
        char *comment = strstr(line, " #");
        if (comment) *comment = '\0';
        separator = separator_of(line);
        data->columns = csv_cut(line, separator, data->names);
    }
    if (!data->columns) return refuse(data, message, message_size, "%s: no header line", path);
    return separator == ',' ? 0 : check_decimals(data, path, message, message_size);
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

/* ---- columns by name and unit ---- */

typedef struct unit {
    const char *name;
    char dimension;
    double si;
} unit;
static const unit units[] = {
    {"m", 'L', 1.0},
    {"mm", 'L', 1e-3},
    {"cm", 'L', 1e-2},
    {"um", 'L', 1e-6},
    {"\xc2\xb5m", 'L', 1e-6}, /* the micro sign in UTF-8, the Greek letter, the sign in Latin-1 */
    {"\xce\xbcm", 'L', 1e-6},
    {"\xb5m", 'L', 1e-6},
    {"micron", 'L', 1e-6},
    {"nm", 'L', 1e-9},
    {"s", 'T', 1.0},
    {"sec", 'T', 1.0},
    {"ms", 'T', 1e-3},
    {"us", 'T', 1e-6},
    {"min", 'T', 60.0},
    {"h", 'T', 3600.0},
    {"kg", 'M', 1.0},
    {"g", 'M', 1e-3},
    {"mg", 'M', 1e-6},
    {"Mg", 'M', 1e3},
    {"t", 'M', 1e3},
    {"m3", 'V', 1.0},
    {"l", 'V', 1e-3},
    {"ml", 'V', 1e-6},
    {"mL", 'V', 1e-6},
    {"Ml", 'V', 1e3},
    {"cm3", 'V', 1e-6},
    {"mm3", 'V', 1e-9},
    {"m2", 'A', 1.0},
    {"cm2", 'A', 1e-4},
    {"mm2", 'A', 1e-6},
    {"kg/m2", 'a', 1.0},
    {"kg_m2", 'a', 1.0},
    {"in", 'L', 0.0254},
    {"pa", 'P', 1.0},
    {"kpa", 'P', 1e3},
    {"MPa", 'P', 1e6},
    {"mPa", 'P', 1e-3},
    {"bar", 'P', 1e5},
    {"mbar", 'P', 100.0},
    {"hpa", 'P', 100.0},
    {"psi", 'P', 6894.757293168},
    {"rad", 'W', 1.0},
    {"deg", 'W', RIDDLE_DEG},
    {"\xc2\xb0", 'W', RIDDLE_DEG},
    {"m/s", 'v', 1.0},
    {"m_s", 'v', 1.0},
    {"m_per_s", 'v', 1.0},
    {"mm/s", 'v', 1e-3},
    {"mm_s", 'v', 1e-3},
    {"mm_per_s", 'v', 1e-3},
    {"rad/s", 'w', 1.0},
    {"rad_s", 'w', 1.0},
    {"rad_per_s", 'w', 1.0},
    {"hz", 'f', 1.0},
    {"1/s", 'f', 1.0},
    {"1/min", 'f', 1.0 / 60},
    {"rpm", 'f', 1.0 / 60},
    {"u/min", 'f', 1.0 / 60},
    {"kg/s", 'q', 1.0},
    {"kg_s", 'q', 1.0},
    {"kg_per_s", 'q', 1.0},
    {"t/h", 'q', 1e3 / 3600},
    {"t_per_h", 'q', 1e3 / 3600},
    {"kg/h", 'q', 1.0 / 3600},
    {"j", 'E', 1.0},
    {"n", 'F', 1.0},
    {"%", 's', 0.01},
    {"percent", 's', 0.01},
    {"permille", 's', 1e-3},
    {"-", 's', 1.0},
};

char csv_small(char c) { return (char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); }

static bool same_letters(const char *a, const char *b) {
    while (*a && csv_small(*a) == csv_small(*b)) a++, b++;
    return *a == *b;
}

/* Letters may be of any case unless that tells two units apart: BAR is bar, but MPA may be MPa or mPa, and measures
   nothing. */
static const unit *unit_of(const char *name) {
    static const unit either = {"", '?', 1.0};
    const unit *alike = NULL;
    bool several = false;
    for (size_t k = 0; k < sizeof units / sizeof *units; k++) {
        if (strcmp(name, units[k].name) == 0) return &units[k];
        if (!same_letters(name, units[k].name)) continue;
        several |= alike && alike->si != units[k].si;
        alike = &units[k];
    }
    return several ? &either : alike;
}

int csv_unit(const char *name, char *dimension, double *si) {
    const unit *found = unit_of(name);
    if (found) *dimension = found->dimension, *si = found->si;
    return found != NULL;
}

static void make_small(char *text) {
    for (; *text; text++) *text = csv_small(*text);
}

/* A name in small letters, cut into what it names and its unit; found: the unit's row, NULL without one. false: a unit
   in brackets that is none of the table. */
static bool split_name(const char *name, char *base, size_t size, const unit **found) {
    size_t n = strlen(name);
    *found = NULL;
    if (n + 1 > size) n = size - 1;
    memcpy(base, name, n);
    base[n] = '\0';
    const char close = n > 0 ? base[n - 1] : '\0';
    char *open = close == ']' ? strrchr(base, '[') : close == ')' ? strrchr(base, '(') : NULL;
    if (open) {
        const char *inside = open + 1;
        for (n--; base + n > inside && is_blank(base[n - 1]);) n--;
        base[n] = '\0';
        while (is_blank(*inside)) inside++;
        *found = unit_of(inside);
        while (open > base && (is_blank(open[-1]) || open[-1] == '_')) open--;
        *open = '\0';
        return make_small(base), *found != NULL;
    }
    for (char *bar = strchr(base, '_'); bar; bar = strchr(bar + 1, '_')) {
        *found = unit_of(bar + 1);
        if (!*found) continue;
        *bar = '\0';
        break;
    }
    return make_small(base), true;
}

static void say_columns(const csv_data *data, char *message, int size, const char *format, const char *name) {
    if (!message || size <= 0) return;
    int n = snprintf(message, (size_t)size, format, name);
    for (int k = 0; k < data->columns && n >= 0 && n < size; k++)
        n += snprintf(message + n, (size_t)(size - n), "%s%.60s", k ? ", " : "; the columns are ", data->names[k]);
}

int csv_is(const char *name, const char *wanted, double *factor) {
    *factor = 1.0;
    char base[128], asked[128];
    const unit *in, *out;
    /* most columns of most tables: csv_value asks for every cell */
    if (csv_small(*name) != csv_small(*wanted)) return 0;
    const bool known = split_name(name, base, sizeof base, &in);
    split_name(wanted, asked, sizeof asked, &out);
    if (strcmp(base, asked) != 0 || (out && known && !in)) return 0;
    if (!known || (in && out && in->dimension != out->dimension)) return -1;
    *factor = (in ? in->si : 1.0) / (out ? out->si : 1.0);
    return 1;
}

int csv_find(const csv_data *data, const char *name, double *factor, char *message, int message_size) {
    int found = -1;
    bool convertible = true, exact = false;
    double scale = 1.0, here;
    for (int k = 0; k < data->columns && !exact; k++) {
        const int is = csv_is(data->names[k], name, &here);
        if (is < 0) convertible = false;
        if (is <= 0) continue;
        exact = strcmp(data->names[k], name) == 0;
        if (found >= 0 && !exact) {
            say_columns(data, message, message_size, "two columns are named %s", name);
            return -1;
        }
        found = k;
        scale = here;
    }
    for (int k = found + 1; found >= 0 && k < data->columns; k++) {
        if (strcmp(data->names[k], data->names[found]) != 0) continue;
        say_columns(data, message, message_size, "two columns are named %s", name);
        return -1;
    }
    if (factor) *factor = scale;
    if (found < 0)
        say_columns(data, message, message_size,
                    convertible ? "no column %s" : "the unit of column %s cannot be converted", name);
    return found;
}

int csv_measures(const char *name, char dimension) {
    char base[128];
    const unit *in;
    if (!split_name(name, base, sizeof base, &in)) return 0;
    return !in || in->dimension == dimension || (dimension == '#' && strcmp(in->name, "-") == 0);
}

int csv_column(const csv_data *data, const char *name) { return csv_find(data, name, NULL, NULL, 0); }

double csv_value(const csv_data *data, int row, const char *name) {
    double factor;
    const int k = csv_find(data, name, &factor, NULL, 0);
    if (k < 0 || row < 0 || row >= data->rows) return (double)NAN;
    const double value = data->values[(size_t)row * (size_t)data->columns + (size_t)k];
    return factor == 1.0 ? value : value * factor;
}

void csv_free(csv_data *data) {
    static const csv_data empty;
    free(data->memory);
    free(data->names);
    free(data->cells);
    free(data->values);
    free(data->lines);
    free(data->is_text);
    *data = empty;
}
