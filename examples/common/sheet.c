#define _POSIX_C_SOURCE 200809L
/* sheet.c: tables by the names of their columns; see sheet.h */
#include "sheet.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "input.h"
#include "sheet_words.h"

/* ---- columns by name ---- */

const char *sheet_words_of(const char *name) {
    for (size_t k = 0; k < sizeof sheet_names / sizeof *sheet_names; k++)
        if (strcmp(sheet_names[k].name, name) == 0) return sheet_names[k].words;
    return name;
}

/* Do the words of a heading from `at` on consist of other names of a column? */
static bool is_named(const char *words, const sheet_heading *h, int at, int named) {
    if (at == h->n) return named > 0;
    char joined[200] = "";
    for (int k = at; k < h->n && k < at + 3; k++) {
        const size_t used = strlen(joined);
        snprintf(joined + used, sizeof joined - used, "%s%s", k > at ? "_" : "", h->words[k]);
        if (sheet_is_word(words, joined) && is_named(words, h, k + 1, named + 1)) return true;
    }
    return sheet_is_word(sheet_harmless, h->words[at]) && is_named(words, h, at + 1, named);
}

/* Of two columns with other names of one, the one with this very name is meant. */
static bool is_exactly(const sheet_heading *h, const char *name) {
    char joined[200] = "", folded[60];
    for (int k = 0; k < h->n; k++) {
        const size_t used = strlen(joined);
        snprintf(joined + used, sizeof joined - used, "%s%s", k ? "_" : "", h->words[k]);
    }
    sheet_fold(name, folded, sizeof folded);
    return strcmp(joined, folded) == 0;
}

static bool fits(const sheet_heading *h, char dimension) {
    if (dimension == '%') dimension = 's';
    return !h->dimension || dimension == 't' || h->dimension == dimension || (h->dimension == 's' && h->si == 1.0) ||
           (dimension == '#' && h->dimension == 's');
}

/* Finds the columns among these headings; returns how many of those that are needed are missing, or -1
   and a message. */
static int find_columns(const char **names, int n, sheet_column *want, int wants, const char *path, char *message,
                        int size) {
    int missing = 0;
    for (int w = 0; w < wants; w++) {
        sheet_column *c = &want[w];
        int twice = -1;
        c->index = -1;
        bool exact = false, unfit = false;
        for (int k = 0; k < n; k++) {
            sheet_heading h;
            char raw[60];
            sheet_read_heading(names[k], &h);
            sheet_fold(names[k], raw, sizeof raw);
            if (sheet_is_word(sheet_words_of(c->name), raw)) h.dimension = 0; /* x_h is no x in hours */
            else if (!is_named(sheet_words_of(c->name), &h, 0, 0)) continue;
            if (!fits(&h, c->dimension)) {
                unfit = true;
                continue;
            }
            const bool here = is_exactly(&h, c->name);
            if (c->index >= 0 && here == exact) twice = k;
            if (c->index >= 0 && here <= exact) continue;
            c->index = k, c->heading = names[k], exact = here, twice = here ? -1 : twice;
            c->factor = h.dimension ? h.si : 1.0;
        }
        if (twice >= 0) return sheet_refuse_columns(message, size, path, "several columns are ", c->name, names, n);
        if (c->index < 0 && unfit)
            return sheet_refuse_columns(message, size, path, "the unit cannot be one of ", c->name, names, n);
        missing += c->index < 0 && c->needed;
    }
    return missing;
}

/* Letters to change, put in or leave out to make one word of the other (Levenshtein); at most 20 letters count. */
static int distance(const char *a, const char *b) {
    enum { MOST = 20 };
    int row[MOST + 1], width = (int)strlen(b);
    for (int j = 0; j <= MOST; j++) row[j] = j;
    width = width < MOST ? width : MOST;
    for (int i = 0; a[i] && i < MOST; i++) {
        int diagonal = row[0];
        row[0] = i + 1;
        for (int j = 1; j <= width; j++) {
            const int kept = diagonal + (a[i] != b[j - 1]), changed = 1 + (row[j] < row[j - 1] ? row[j] : row[j - 1]);
            diagonal = row[j];
            row[j] = kept < changed ? kept : changed;
        }
    }
    return row[width];
}

/* Takes the next of some words; false: there is none. */
static bool next_word(const char **words, char word[40]) {
    *words += strspn(*words, " ");
    const size_t n = strcspn(*words, " ");
    snprintf(word, 40, "%.*s", (int)(n < 39 ? n : 39), *words);
    *words += n;
    return n > 0;
}

/* Does a heading begin with one of these words, whatever follows: "Druckdifferenz in mmHg"? A long first word may have
   a mistake in it; a short one would be another word. */
static bool begins_with(const sheet_heading *h, const char *words) {
    int from = 0;
    while (from < h->n && sheet_is_word(sheet_harmless, h->words[from])) from++;
    char joined[200] = "";
    for (int k = from; k < h->n && k < from + 3; k++) {
        const size_t used = strlen(joined);
        snprintf(joined + used, sizeof joined - used, "%s%s", k > from ? "_" : "", h->words[k]);
        if (sheet_is_word(words, joined)) return true;
    }
    for (char word[40]; from < h->n && next_word(&words, word);) {
        const size_t n = strlen(word);
        if (n >= 5 && distance(h->words[from], word) <= (n > 6 ? 2 : 1)) return true;
    }
    return false;
}

/* Is another column there that may be named alike, as volume beside mass: "filtrate"? Then this one is not missed. */
static bool has_instead(const sheet_column *want, int wants, int missing) {
    const char *words = sheet_words_of(want[missing].name);
    for (int w = 0; w < wants; w++) {
        if (want[w].index < 0) continue;
        const char *at = words, *others = sheet_words_of(want[w].name);
        for (char word[40]; next_word(&at, word);)
            if (sheet_is_word(others, word)) return true;
    }
    return false;
}

/* A column that is nearly one that may be missing, by any of its names: a default in its place would be wrong. */
static int refuse_near(const char **names, int n, const sheet_column *want, int wants, const char *path, char *message,
                       int size) {
    for (int k = 0; k < n; k++) {
        sheet_heading h;
        bool taken = false;
        sheet_read_heading(names[k], &h);
        for (int w = 0; w < wants; w++) taken |= want[w].index == k;
        if (taken || h.n < 1) continue;
        const char *word = h.words[0];
        for (int w = 0; w < wants; w++)
            if (want[w].index < 0 && !has_instead(want, wants, w) &&
                ((strlen(word) >= 4 && distance(word, want[w].name) <= (strlen(word) > 4 ? 2 : 1)) ||
                 begins_with(&h, sheet_words_of(want[w].name))))
                return sheet_refuse(message, size,
                                    "%s: a column %s, in a unit such as _mm, _percent, _kg_m2; there is '%.60s'", path,
                                    want[w].name, names[k]);
    }
    return 0;
}

/* ---- a table ---- */

void sheet_free(sheet *s) {
    static const sheet empty;
    for (int k = 0; k < 4; k++) free(s->memory[k]);
    *s = empty;
}

static const char *si_unit(char dimension) {
    static const char *const units[] = {"Lm", "Ts", "Mkg", "Vm3", "PPa", "Wrad", "vm/s", "f1/s", "akg/m2"};
    for (size_t k = 0; k < sizeof units / sizeof *units; k++)
        if (units[k][0] == dimension) return units[k] + 1;
    return "";
}

/* Numbers of a column in SI; text and empty cells are NaN, what is no number of its kind is refused. */
static int read_column(const sheet_text *t, const int *rows, int n, sheet_column *c, const sheet_marks *marks,
                       double *value, const char *path, char *message, int size) {
    double largest = 0.0;
    bool said = c->factor != 1.0;
    const char kind = c->dimension == '%' ? 's' : c->dimension;
    for (int i = 0; i < n; i++) {
        const int r = rows[i];
        const char *cell = c->index < t->first[r + 1] - t->first[r] ? t->cell[t->first[r] + c->index] : "", *end;
        char dimension = 0;
        double si = 1.0;
        value[i] = (double)NAN;
        if (!*cell || c->dimension == 't') continue;
        const int unit = sheet_scan(cell, marks, &value[i], &end) ? sheet_unit(end, &dimension, &si) : -1;
        if (unit < 0 || (unit > 0 && dimension != kind))
            return sheet_refuse(message, size, "%s:%d: column '%.60s': '%.60s' is not a number", path, t->line[r],
                                c->heading, cell);
        if (kind == 's' && unit == 0 && fabs(value[i]) > largest) largest = fabs(value[i]);
        said |= unit > 0;
        value[i] = value[i] * (unit > 0 ? si : c->factor);
    }
    if (kind != 's' || said || !(largest > 1.5)) return 0;
    if (c->dimension == 's')
        return sheet_refuse(message, size,
                            "%s: column '%.60s': a share of %g; in per cent, its heading says so, such as %s_percent",
                            path, c->heading, largest, c->name);
    c->factor = 0.01; /* per cent, although nothing says so */
    for (int i = 0; i < n; i++) value[i] *= 0.01;
    return 0;
}

static void say_how(sheet *s, const sheet_text *t, const sheet_marks *marks, const sheet_column *want, int n,
                    const char *path) {
    const int size = (int)sizeof s->how;
    char said[SHEET_MARKS];
    int at = snprintf(s->how, (size_t)size, "%.150s: %s%d rows", path, sheet_marks_text(t, marks, said), s->rows);
    for (int w = 0; w < n && at >= 0 && at < size; w++) {
        if (want[w].index < 0) continue;
        at += snprintf(s->how + at, (size_t)(size - at), "%s %s from '%.40s'", w ? "," : ";", want[w].name,
                       want[w].heading);
        if (want[w].dimension == 't' || at >= size) continue;
        at += snprintf(s->how + at, (size_t)(size - at), " %.6g ... %.6g%s%s", want[w].value[0],
                       want[w].value[s->rows - 1], *si_unit(want[w].dimension) ? " " : "", si_unit(want[w].dimension));
    }
}

int sheet_parse(const char *bytes, long size, const char *path, sheet_column *want, int wants, sheet *out,
                char *message, int message_size) {
    static const sheet empty;
    const char *names[SHEET_COLUMNS];
    static const char nothing[1];
    char room[SHEET_COLUMNS * 184];
    int head = -1, lines = 1, missing = 1, n = 0, first_text = -1;
    sheet_text t;
    sheet_marks marks;
    *out = empty;
    if (sheet_cut(bytes, size, path, &t, message, message_size)) return -1;
    for (int r = 0; r < t.rows && r < 60 && missing > 0; r++)
        for (lines = sheet_heading_lines(&t, r); lines > 0; lines = lines > 1 ? 1 : 0) {
            n = sheet_headings(&t, r, lines, names, room, sizeof room);
            missing = find_columns(names, n, want, wants, path, message, message_size);
            head = r;
            if (first_text < 0 && n > 1) first_text = r;
            if (missing <= 0) break;
        }
    if (missing < 0) {
        sheet_text_free(&t);
        return -1;
    }
    if (missing) { /* list those of the first line with several */
        n = sheet_headings(&t, first_text < 0 ? 0 : first_text, 1, names, room, sizeof room);
        find_columns(names, n, want, wants, path, message, message_size);
        int w = 0;
        while (w < wants - 1 && (want[w].index >= 0 || !want[w].needed)) w++;
        sheet_refuse_columns(message, message_size, path, "no column ", want[w].name, names, n);
        sheet_text_free(&t);
        return -1;
    }
    const int width = n, after = head + (lines > 1 ? 2 : 1);
    int *kept = malloc((size_t)(t.rows + 1) * sizeof *kept), column[SHEET_COLUMNS], used = 0, rows = 0, failed = 0;
    double *values = malloc((size_t)(t.rows + 1) * (size_t)wants * sizeof *values);
    const char **cells = malloc((size_t)(t.rows + 1) * (size_t)(width + 1) * sizeof *cells);
    int *line = malloc((size_t)(t.rows + 1) * sizeof *line);
    if (!kept || !values || !cells || !line) failed = sheet_refuse(message, message_size, "%s: out of memory", path);
    for (int r = after; r < t.rows && !failed; r++) {
        const int here = t.first[r + 1] - t.first[r];
        if (sheet_is_total(&t, r)) continue;
        for (int k = width; k < here && !failed; k++)
            if (*t.cell[t.first[r] + k])
                failed = sheet_refuse(
                    message, message_size, "%s:%d: %d cells, but the heading names %d%s", path, t.line[r], here, width,
                    t.separator == ',' ? ": decimal commas need semicolons or tabs between cells" : "");
        for (int k = 0; k < width; k++) cells[rows * width + k] = k < here ? t.cell[t.first[r] + k] : nothing;
        line[rows] = t.line[r], kept[rows++] = r;
    }
    for (int w = 0; w < wants; w++)
        if (want[w].index >= 0 && want[w].dimension != 't') column[used++] = want[w].index;
    failed = failed || refuse_near(names, width, want, wants, path, message, message_size);
    if (!failed && rows == 0)
        failed = sheet_refuse(message, message_size, "%s: no rows below the heading in line %d", path, t.line[head]);
    failed = failed || sheet_find_marks(&t, after, column, used, path, &marks, message, message_size);
    for (int w = 0; w < wants && !failed; w++) {
        sheet_column *c = &want[w];
        c->value = NULL;
        if (c->index < 0) continue;
        failed = read_column(&t, kept, rows, c, &marks, values + w * rows, path, message, message_size);
        c->value = values + w * rows,
        c->heading = t.cell[t.first[head] + (c->index < t.first[head + 1] - t.first[head] ? c->index : 0)];
    }
    free(kept);
    if (failed) {
        free(values), free((void *)cells), free(line);
        sheet_text_free(&t);
        return -1;
    }
    out->rows = rows, out->columns = width, out->cell = cells, out->line = line;
    say_how(out, &t, &marks, want, wants, path);
    out->memory[0] = t.memory[0], t.memory[0] = NULL; /* the text of the cells */
    out->memory[1] = values, out->memory[2] = (void *)cells, out->memory[3] = line;
    sheet_text_free(&t);
    return 0;
}

int sheet_read(const char *path, sheet_column *columns, int n, sheet *out, char *message, int message_size) {
    static const sheet empty;
    size_t size;
    *out = empty;
    char *bytes = input_read(path, &size, message, (size_t)message_size);
    const int status = bytes ? sheet_parse(bytes, (long)size, path, columns, n, out, message, message_size) : -1;
    free(bytes);
    return status;
}
