#define _POSIX_C_SOURCE 200809L
/* sheet_text.c: bytes to cells, headings to words and units, cells to numbers; see sheet.h */
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "csv.h"
#include "sheet_words.h"
#include "utf8.h"

/* No control characters to a terminal. */
static int clean(char *message) {
    for (char *c = message; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127) *c = '?';
    return -1;
}

int sheet_refuse(char *message, int size, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, (size_t)size, format, arguments);
    va_end(arguments);
    return clean(message);
}

/* ---- bytes to text in UTF-8 with plain blanks, quotes and minus signs ---- */

static size_t put_rune(char *out, uint32_t c) {
    switch (c) {
    case 0xa0:
    case 0x2007:
    case 0x2009:
    case 0x202f: c = ' '; break; /* blanks that do not break a line */
    case 0x2010:
    case 0x2011:
    case 0x2012:
    case 0x2013:
    case 0x2014:
    case 0x2212: c = '-'; break;
    case 0x201c:
    case 0x201d:
    case 0x201e:
    case 0x2033: c = '"'; break; /* quotes, and the sign of inches */
    case 0x2018:
    case 0x2019: c = '\''; break;
    case 0xfeff: return 0;
    default: break;
    }
    if (c < 0x80) return (size_t)((out[0] = (char)c) != 0 || 1);
    if (c < 0x800) return (size_t)((out[0] = (char)(0xc0 | c >> 6), out[1] = (char)(0x80 | (c & 63)), 2));
    if (c < 0x10000)
        return (size_t)((out[0] = (char)(0xe0 | c >> 12), out[1] = (char)(0x80 | (c >> 6 & 63)),
                         out[2] = (char)(0x80 | (c & 63)), 3));
    out[0] = (char)(0xf0 | (c >> 18 & 7)), out[1] = (char)(0x80 | (c >> 12 & 63));
    out[2] = (char)(0x80 | (c >> 6 & 63)), out[3] = (char)(0x80 | (c & 63));
    return 4;
}

/* 0 for 8 bits a character, else the byte order of UTF-16: 1 little, 2 big. */
static int wide_order(const unsigned char *bytes, size_t size) {
    if (size >= 2 && bytes[0] == 0xff && bytes[1] == 0xfe) return 1;
    if (size >= 2 && bytes[0] == 0xfe && bytes[1] == 0xff) return 2;
    if (size >= 4 && bytes[0] && !bytes[1] && bytes[2] && !bytes[3]) return 1;
    return size >= 4 && !bytes[0] && bytes[1] && !bytes[2] && bytes[3] ? 2 : 0;
}

/* Latin-1 as Windows writes it: what its bytes from 0x80 mean; others are their own number. */
static uint32_t latin(unsigned char c) {
    return c == 0x93 || c == 0x94 || c == 0x84 ? '"' : c == 0x91 || c == 0x92 ? '\'' : c == 0x96 || c == 0x97 ? '-' : c;
}

static char *to_utf8(const char *raw, size_t size) {
    const unsigned char *bytes = (const unsigned char *)raw;
    char *text = malloc(3 * size + 8);
    const int wide = wide_order(bytes, size);
    size_t n = 0, length;
    uint32_t c = 0;
    bool utf8 = true;
    if (!text) return NULL;
    for (size_t i = 0; i < size && !wide && utf8; i += length) utf8 = (length = utf8_get(bytes + i, size - i, &c)) > 0;
    if (wide) {
        for (size_t i = 0; i + 1 < size; i += 2) {
            c = wide == 1 ? (uint32_t)(bytes[i] | bytes[i + 1] << 8) : (uint32_t)(bytes[i + 1] | bytes[i] << 8);
            n += put_rune(text + n, c >= 0xd800 && c < 0xe000 ? '?' : c);
        }
    } else if (utf8) {
        for (size_t i = 0; i < size; i += length)
            length = utf8_get(bytes + i, size - i, &c), n += put_rune(text + n, c);
    } else {
        for (size_t i = 0; i < size; i++) n += put_rune(text + n, latin(bytes[i]));
    }
    text[n] = '\0';
    if (strlen(text) == n) return text;
    free(text);
    return NULL;
}

/* ---- text to cells ---- */

static bool is_digit(char c) { return c >= '0' && c <= '9'; }
static bool is_space(char c) { return c == ' ' || c == '\r'; }

/* Line ends within a quoted cell become blanks, if its quote closes before the next cell. */
static void join_quoted(char *text, char separator) {
    const char stops[3] = {separator, '\n', '\0'};
    char before = '\n';
    for (char *at = text; *at; before = *at++) {
        if (*at != '"' || (before != separator && before != '\n')) continue;
        char *close = at + csv_quoted(at, stops);
        if (close == at || close - at > 200) continue;
        for (char *c = at; c < close; c++)
            if (*c == '\n' || *c == '\r') *c = ' ';
        at = close;
    }
}

/* Lines of text, ended by 0; comments, empty ones and a line "sep=;" are left out. */
static int split_lines(char *text, char **lines, int *number, char *separator) {
    int n = 0, at = 0;
    for (char *line = text, *next; line; line = next) {
        char *end = line + strcspn(line, "\n");
        next = *end ? end + 1 : NULL;
        *end = '\0';
        at++;
        while (is_space(*line)) line++;
        if (strncmp(line, "sep=", 4) == 0 && line[4] && !line[5 + strspn(line + 5, " ")]) {
            *separator = line[4];
            continue;
        }
        char *note = strstr(line, " # ");
        if (note) *note = '\0';
        if (!line[strspn(line, " \t\r;,")] || (*line == '#' && !(line[1] >= '0' && line[1] <= '9'))) continue;
        lines[n] = line, number[n++] = at;
    }
    return n;
}

static int count_of(const char *line, char separator) {
    static const char stops[] = ",;\t";
    int n = 0;
    bool begins = true; /* a cell: only there a quote is one around it */
    for (; *line; line++) {
        if (begins) line += csv_quoted(line, stops);
        n += *line == separator;
        begins = strchr(stops, *line) || (begins && is_space(*line));
    }
    return n;
}

/* What separates the cells: what most lines have, of tabs, semicolons, commas; where the line before the first numbers
   has none: blanks. */
static char find_separator(char *const *lines, int n) {
    static const char choices[3] = {'\t', ';', ','};
    for (int k = 0; k < 3; k++) {
        int have = 0, first = -1;
        for (int i = 0; i < n; i++) {
            if (count_of(lines[i], choices[k]) == 0) continue;
            have++;
            if (first < 0 && lines[i][0] && strpbrk(lines[i], "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ%"))
                first = i;
        }
        if (2 * have >= n && have > 0 && (choices[k] != ',' || first >= 0)) return choices[k];
    }
    return ' ';
}

/* Cells of a line where blanks separate them; several are one. */
static int cut_blanks(char *line, const char **cells) {
    int n = 0;
    for (char *at = line;;) {
        while (is_space(*at) || *at == '\t') at++;
        if (!*at) return n;
        cells[n++] = at;
        for (int open = 0;
             *at && (open > 0 || (!is_space(*at) && *at != '\t') || (is_space(*at) && (at[1] == '[' || at[1] == '(')));
             at++)
            open += (*at == '[' || *at == '(') - (*at == ']' || *at == ')'); /* a unit in brackets belongs to
                                                                                the word before */
        if (*at) *at++ = '\0';
    }
}

void sheet_text_free(sheet_text *t) {
    static const sheet_text empty;
    for (int k = 0; k < 4; k++) free(t->memory[k]);
    *t = empty;
}

int sheet_cut(const char *bytes, long size, const char *path, sheet_text *out, char *message, int message_size) {
    static const sheet_text empty;
    *out = empty;
    char *text = size >= 0 ? to_utf8(bytes, (size_t)size) : NULL;
    size_t most = 2, lines_most = 2;
    out->memory[0] = text;
    if (!text) return sheet_refuse(message, message_size, "%s: not a text file", path);
    for (char *c = text; *c; c++) { /* any line end becomes one \n */
        if (*c == '\r') *c = c[1] == '\n' ? ' ' : '\n';
        most += *c == ',' || *c == ';' || *c == '\t' || *c == ' ' || *c == '\n', lines_most += *c == '\n';
        if ((unsigned char)*c < 32 && *c != '\n' && *c != '\t') *c = ' ';
    }
    char **lines = malloc(lines_most * sizeof *lines);
    out->memory[1] = malloc((most + lines_most) * sizeof *out->cell);
    out->memory[2] = malloc((lines_most + 1) * sizeof *out->first);
    out->memory[3] = malloc(lines_most * sizeof *out->line);
    out->cell = (const char **)out->memory[1], out->first = (int *)out->memory[2], out->line = (int *)out->memory[3];
    if (!lines || !out->cell || !out->first || !out->line || most > 20000000) {
        free(lines);
        sheet_text_free(out);
        return sheet_refuse(message, message_size, "%s: too long, or out of memory", path);
    }
    join_quoted(text, ';'), join_quoted(text, ','), join_quoted(text, '\t');
    char separator = '\0';
    int used = 0;
    out->rows = split_lines(text, lines, out->line, &separator);
    out->separator = separator ? separator : find_separator(lines, out->rows);
    for (int r = 0; r < out->rows; r++) {
        out->first[r] = used;
        char **cells = (char **)(void *)(out->cell + used);
        used +=
            out->separator == ' ' ? cut_blanks(lines[r], out->cell + used) : csv_cut(lines[r], out->separator, cells);
    }
    out->first[out->rows] = used;
    free(lines);
    if (out->rows > 0) return 0;
    sheet_text_free(out);
    return sheet_refuse(message, message_size, "%s: no lines with cells", path);
}

/* ---- words and units ---- */

/* cased: plain letters stay as they are, since of a unit they may count: mPa, MPa. Both ways have one length. */
static void fold(const char *text, char *out, size_t size, bool cased) {
    static const struct {
        uint32_t rune;
        const char *text;
    } folds[] = {{0xe4, "ae"},   {0xf6, "oe"},  {0xfc, "ue"},        {0xc4, "ae"},    {0xd6, "oe"},   {0xdc, "ue"},
                 {0xdf, "ss"},   {0xe9, "e"},   {0xe8, "e"},         {0xb5, "u"},     {0x3bc, "u"},   {0xb2, "2"},
                 {0xb3, "3"},    {0xb0, "deg"}, {0x3c6, "phi"},      {0x3d5, "phi"},  {0x3a6, "phi"}, {0x2300, "d"},
                 {0xd8, "d"},    {0xf8, "d"},   {0x3a3, "sum"},      {0x2211, "sum"}, {0x2264, "<"},  {0x2265, ">"},
                 {0x2026, ".."}, {0x394, "d"},  {0x2030, "permille"}};
    const unsigned char *at = (const unsigned char *)text;
    size_t n = 0, left = strlen(text), length;
    uint32_t c = 0;
    while (left > 0 && n + 4 < size) {
        if ((length = utf8_get(at, left, &c)) == 0) length = 1, c = '?';
        at += length, left -= length;
        if (c < 0x80) {
            out[n++] = cased ? (char)c : csv_small((char)c);
            continue;
        }
        const char *as = "?";
        for (size_t k = 0; k < sizeof folds / sizeof *folds; k++)
            if (folds[k].rune == c) as = folds[k].text;
        while (*as && n + 1 < size) out[n++] = *as++;
    }
    out[n] = '\0';
}

void sheet_fold(const char *text, char *out, size_t size) { fold(text, out, size, false); }

bool sheet_is_word(const char *words, const char *word) {
    const size_t n = strlen(word);
    for (const char *at = words; n > 0 && (at = strstr(at, word)) != NULL; at++)
        if ((at == words || at[-1] == ' ') && (at[n] == ' ' || at[n] == '\0')) return true;
    return false;
}

/* Is a folded text per cent: "%", "wt%", "m.-%", "percent"? */
static bool is_percent(const char *text) {
    static const char *const kinds[] = {"",     "m",      "ma",    "gew",    "wt",  "w",         "v", "vol",
                                        "mass", "massen", "masse", "weight", "w/w", "mass/mass", "n"};
    char left[24];
    size_t n = 0;
    bool found = false;
    for (; *text && n + 1 < sizeof left; text++) {
        if (*text == '%') found = true;
        else if (strncmp(text, "percent", 7) == 0 || strncmp(text, "prozent", 7) == 0) found = true, text += 6;
        else if (!strchr(" .-_", *text)) left[n++] = *text;
    }
    left[n] = '\0';
    for (size_t k = 0; found && !*text && k < sizeof kinds / sizeof *kinds; k++)
        if (strcmp(left, kinds[k]) == 0) return true;
    return false;
}

/* A unit, folded with its letters as they are, without blanks around. */
static bool unit_of(const char *text, char *dimension, double *si) {
    static const struct {
        const char *name, *as;
    } others[] = {{"sek", "s"},         {"sekunden", "s"},    {"seconds", "s"},        {"minutes", "min"},
                  {"minuten", "min"},   {"stunden", "h"},     {"hours", "h"},          {"micron", "um"},
                  {"microns", "um"},    {"mikrometer", "um"}, {"micrometer", "um"},    {"millimeter", "mm"},
                  {"millimetre", "mm"}, {"mym", "um"},        {"gram", "g"},           {"grams", "g"},
                  {"gramm", "g"},       {"liter", "l"},       {"litre", "l"},          {"degrees", "deg"},
                  {"inch", "in"},       {"inches", "in"},     {"zoll", "in"},          {"\"", "in"},
                  {"''", "in"},         {"kg/m^2", "kg/m2"},  {"m^3", "m3"},           {"cm^3", "cm3"},
                  {"fraction", "-"},    {"1", "-"},           {"promille", "permille"}};
    char plain[24], as_written[24];
    size_t n = strlen(text);
    while (n > 0 && (text[n - 1] == ' ' || (text[n - 1] == '.' && n > 1))) n--;
    while (n > 0 && *text == ' ') text++, n--;
    if (n == 0 || n >= sizeof plain) return false;
    for (size_t k = 0; k < n; k++) as_written[k] = text[k], plain[k] = csv_small(text[k]);
    as_written[n] = plain[n] = '\0';
    *si = 0.01, *dimension = 's';
    if (is_percent(plain)) return true;
    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        if (strcmp(plain, others[k].name) == 0) strcpy(as_written, others[k].as);
    return csv_unit(as_written, dimension, si) != 0;
}

static void take_unit(sheet_heading *h, char dimension, double si) {
    h->dimension = dimension, h->si = si;
    h->percent = dimension == 's' && si == 0.01;
}

/* Takes the unit off a folded heading: the last brackets that hold one, else what follows a blank, _, comma, slash or
   "in" at its end. cased: the same with its letters as they are. */
static void cut_unit(char *base, const char *cased, sheet_heading *h) {
    char dimension;
    double si;
    for (char *open = base; (open = strpbrk(open, "[(")) != NULL; open++) {
        char *close = strchr(open, *open == '[' ? ']' : ')'), inside[40];
        if (!close || close - open > 30) continue;
        memcpy(inside, cased + (open + 1 - base), (size_t)(close - open - 1));
        inside[close - open - 1] = '\0';
        const char *unit = strncmp(open + 1, "in ", 3) == 0 ? inside + 3 : inside;
        if (!unit_of(unit, &dimension, &si)) continue;
        take_unit(h, dimension, si);
        memset(open, ' ', (size_t)(close - open + 1));
        return;
    }
    for (char *at = base; *at; at++) {
        if (at > base && !strchr(" _,/", at[-1])) continue;
        const char *unit = strncmp(at, "in ", 3) == 0 && at[3] ? at + 3 : strncmp(at, "in_", 3) == 0 ? at + 3 : at;
        if (strlen(unit) > 20 || !unit_of(cased + (unit - base), &dimension, &si) ||
            (dimension == 's' && si == 1.0 && !strchr("-1", unit[0])))
            continue;
        /* Symbols: "Zeit t". */
        if (unit[0] && !unit[1] && strchr("tm", *unit) && (at == base || at[-1] == ' ') && unit == at) continue;
        take_unit(h, dimension, si);
        *at = '\0';
        return;
    }
}

void sheet_read_heading(const char *text, sheet_heading *h) {
    static const sheet_heading empty;
    char base[200], cased[200], apart[200];
    size_t n = 0;
    *h = empty;
    h->si = 1.0;
    for (const char *c = text; *c && n + 2 < sizeof apart; c++) { /* PercentPassing is two words */
        const bool up =
            *c >= 'A' && *c <= 'Z' && c - text >= 3 && c[1] >= 'a' && c[1] <= 'z' && c[2] >= 'a' && c[2] <= 'z';
        if (up && c[-1] >= 'a' && c[-1] <= 'z' && c[-2] >= 'a' && c[-2] <= 'z') apart[n++] = ' ';
        apart[n++] = *c;
    }
    apart[n] = '\0';
    char *q = strstr(apart, "Q3");
    if (!q) q = strstr(apart, "Q0");
    if (q && (q == apart || q[-1] == ' ')) memcpy(q, "QQ", 2); /* Q3: the sum; q3: the density */
    fold(apart, base, sizeof base, false);
    fold(apart, cased, sizeof cased, true);
    cut_unit(base, cased, h);
    for (char *at = base; *at && h->n < 8;) {
        if (*at == '%') {
            h->percent = true;
            at++;
            continue;
        }
        size_t length = 0;
        while ((at[length] >= 'a' && at[length] <= 'z') || (at[length] >= '0' && at[length] <= '9')) length++;
        if (length == 0) {
            if (*at == '<' || *at == '>' || *at == '#')
                snprintf(h->words[h->n++], sizeof h->words[0], "%s", *at == '<' ? "less" : *at == '>' ? "above" : "no");
            at++;
            continue;
        }
        snprintf(h->words[h->n++], sizeof h->words[0], "%.*s", (int)(length < 39 ? length : 39), at);
        if (strcmp(h->words[h->n - 1], "percent") == 0 || strcmp(h->words[h->n - 1], "prozent") == 0)
            h->percent = true, h->n--;
        else if (strcmp(h->words[h->n - 1], "qq") == 0) strcpy(h->words[h->n - 1], "passing");
        at += length;
    }
    if (h->percent && !h->dimension) h->dimension = 's', h->si = 0.01;
}

int sheet_headings(const sheet_text *t, int row, int lines, const char **names, char *room, size_t size) {
    int n = 0;
    for (int k = 0; k < 2 && k < lines && row + k < t->rows; k++) {
        const int width = t->first[row + k + 1] - t->first[row + k];
        n = n > width ? n : width;
    }
    n = n < SHEET_COLUMNS ? n : SHEET_COLUMNS;
    for (int c = 0; c < n; c++) {
        const char *part[2] = {"", ""};
        for (int k = 0; k < 2 && k < lines && row + k < t->rows; k++)
            if (c < t->first[row + k + 1] - t->first[row + k]) part[k] = t->cell[t->first[row + k] + c];
        names[c] = part[0];
        if (lines < 2) continue;
        const bool bare = lines == 3 && *part[1] && *part[1] != '[' && *part[1] != '(';
        const int used = snprintf(room, size, "%.90s%s%s%.90s%s", part[0], *part[0] && *part[1] ? " " : "",
                                  bare ? "[" : "", part[1], bare ? "]" : "");
        if (used < 0 || (size_t)used + 1 > size) return c;
        names[c] = room, room += used + 1, size -= (size_t)used + 1;
    }
    while (n > 0 && !*names[n - 1]) n--;
    return n;
}

int sheet_heading_lines(const sheet_text *t, int row) {
    bool units = true;
    int cells = 0;
    if (row + 1 >= t->rows) return 1;
    for (int k = t->first[row + 1]; k < t->first[row + 2]; k++) {
        const char *cell = t->cell[k];
        char dimension, inside[24];
        double si;
        if (!*cell) continue;
        cells++;
        if (is_digit(*cell) || strchr("+-.,<>", *cell)) {
            if (strcmp(cell, "-") != 0) return 1;
        }
        const bool open = *cell == '[' || *cell == '(';
        snprintf(inside, sizeof inside, "%.22s", cell + open);
        if (open && *inside) inside[strlen(inside) - 1] = '\0';
        units &= sheet_unit(inside, &dimension, &si) == 1;
    }
    return cells == 0 ? 1 : units ? 3 : 2;
}

bool sheet_is_total(const sheet_text *t, int row) {
    for (int k = t->first[row]; k < t->first[row + 1]; k++) {
        char word[24];
        if (!*t->cell[k]) continue;
        sheet_fold(t->cell[k], word, sizeof word);
        for (size_t n = strlen(word); n > 0 && strchr(" :=.", word[n - 1]);) word[--n] = '\0';
        return sheet_is_word(sheet_total_words, word);
    }
    return false;
}

/* ---- numbers ---- */

/* The digits and marks at the beginning of a text; commas, points in it, and the last mark's place. */
static size_t token_of(const char *text, int *commas, int *points, size_t *last) {
    size_t n = 0;
    *commas = *points = 0, *last = 0;
    while (is_digit(text[n]) ||
           ((text[n] == '.' || text[n] == ',') &&
            (is_digit(text[n + 1]) || (n > 0 && is_digit(text[n - 1]) && text[n + 1] != '.'))) ||
           (n > 0 && (text[n] == ' ' || text[n] == '\'') && is_digit(text[n - 1]) && is_digit(text[n + 1]) &&
            is_digit(text[n + 2]) && is_digit(text[n + 3]) && !is_digit(text[n + 4]))) {
        if (text[n] == ',') ++*commas, *last = n;
        if (text[n] == '.') ++*points, *last = n;
        n++;
    }
    return n;
}

/* One mark, and exactly three digits behind one to three that are not 0: thousands, or decimals? */
static bool in_doubt(const char *token, size_t n, size_t mark) {
    return mark >= 1 && mark <= 3 && token[0] != '0' && n - mark == 4;
}

/* A column whose marks are all in doubt, beside numbers without one: 4.000, 2.000, 500. Do they separate thousands? If
   only one of the two readings rises or falls down the column, it is that; else a number of three digits or a last 0 of
   decimals tells: with decimals of one format every number would have them. 1: they may; 0: nothing tells; -1: no. */
static int may_be_thousands(const sheet_text *t, int from, int column) {
    double before[2] = {0.0, 0.0};
    bool rises[2] = {true, true}, falls[2] = {true, true}, hint = false, bare = false, marked = false;
    for (int r = from, n = 0; r < t->rows; r++) {
        if (column < 0 || column >= t->first[r + 1] - t->first[r] || sheet_is_total(t, r)) continue;
        for (const char *at = t->cell[t->first[r] + column]; *at;) {
            int commas, points;
            size_t last;
            const size_t length = token_of(at, &commas, &points, &last);
            if (length > 0 && length < 12) {
                const bool mark = commas + points > 0;
                const double head = floor(strtod(at, NULL)), tail = mark ? strtod(at + last + 1, NULL) : 0.0;
                const double value[2] = {mark ? head + 1e-3 * tail : head, mark ? 1e3 * head + tail : head};
                for (int k = 0; k < 2; k++) {
                    rises[k] &= n == 0 || value[k] >= before[k], falls[k] &= n == 0 || value[k] <= before[k];
                    before[k] = value[k];
                }
                hint |= mark ? at[length - 1] == '0' : length == 3 && *at != '0';
                bare |= !mark && head > 0.0;
                marked |= mark;
                n++;
            }
            at += length ? length : 1;
        }
    }
    const bool decimals = rises[0] || falls[0], thousands = rises[1] || falls[1];
    if (!marked || (decimals && !thousands)) return -1;
    return bare && (decimals == thousands ? hint : thousands);
}

int sheet_find_marks(const sheet_text *t, int from, const int *column, int n, const char *path, sheet_marks *marks,
                     char *message, int message_size) {
    bool sure[2] = {false, false}, grouped[2] = {false, false}; /* of commas, of points */
    int doubt[2] = {-1, -1}, row_of[2] = {0, 0};
    const char *token[2] = {NULL, NULL};
    marks->doubtful[0] = '\0';
    for (int r = from; r < t->rows; r++)
        for (int k = 0; k < n; k++) {
            if (column[k] < 0 || column[k] >= t->first[r + 1] - t->first[r]) continue;
            const char *cell = t->cell[t->first[r] + column[k]];
            for (const char *at = cell; *at;) {
                int commas, points;
                size_t last;
                const size_t length = token_of(at, &commas, &points, &last);
                if (commas && points) sure[at[last] == '.'] = true, grouped[at[last] != '.'] = true;
                else if (commas > 1) grouped[0] = sure[1] = true;
                else if (points > 1) grouped[1] = sure[0] = true;
                else if (commas + points == 1) {
                    const int mark = points;
                    if (!in_doubt(at, length, last)) sure[mark] = true;
                    else if (doubt[mark] < 0) doubt[mark] = t->first[r] + column[k], row_of[mark] = r, token[mark] = at;
                }
                at += length ? length : 1;
            }
        }
    for (int mark = 0; mark < 2; mark++) { /* a number that may have thousands */
        const int other = 1 - mark;
        bool clear = sure[mark]
                         ? !sure[other] && !grouped[mark]
                         : grouped[mark] || (!sure[other] && doubt[other] < 0 && (mark == 1 || t->separator != ','));
        bool told = true;
        for (int k = 0; k < n && clear && !sure[mark] && !grouped[mark]; k++) {
            const int thousands = may_be_thousands(t, from, column[k]);
            clear = thousands <= 0, told &= thousands < 0;
        }
        if (doubt[mark] >= 0 && !told) snprintf(marks->doubtful, sizeof marks->doubtful, "%s", token[mark]);
        if (doubt[mark] < 0 || clear) continue;
        return sheet_refuse(message, message_size,
                            "%s:%d: '%.60s' may be in thousands: write numbers without a mark for them", path,
                            t->line[row_of[mark]], t->cell[doubt[mark]]);
    }
    const bool comma = sure[0] || (!sure[1] && doubt[0] >= 0 && !grouped[0]),
               point = sure[1] || (!sure[0] && doubt[1] >= 0 && !grouped[1]);
    marks->decimal = comma && point ? '\0' : comma ? ',' : '.';
    marks->grouped = grouped[0] || grouped[1];
    return 0;
}

const char *sheet_marks_text(const sheet_text *t, const sheet_marks *marks, char text[SHEET_MARKS]) {
    const char *kind = marks->decimal == ',' ? "decimal commas" : "decimal points", *end;
    double value;
    text[0] = '\0';
    if (marks->doubtful[0] && sheet_scan(marks->doubtful, marks, &value, &end))
        snprintf(text, SHEET_MARKS, "%s (no number shows whether '%.*s' means %.10g or %.10g: it is read as %.10g), ",
                 kind, (int)(end - marks->doubtful), marks->doubtful, value, 1e3 * value, value);
    else if (marks->decimal == ',' || (t->separator == ';' && marks->decimal == '.'))
        snprintf(text, SHEET_MARKS, "%s, ", kind);
    return text;
}

bool sheet_scan(const char *text, const sheet_marks *marks, double *value, const char **end) {
    char plain[64];
    int commas, points;
    size_t last, n = 0;
    const char *at = text;
    while (*at == ' ') at++;
    if (*at == '-' || *at == '+') plain[n++] = *at++;
    const size_t length = token_of(at, &commas, &points, &last);
    if (length == 0 || length > 40) return false;
    const char decimal = commas && points ? at[last]
                         : commas > 1     ? '.'
                         : points > 1     ? ','
                         : marks->decimal ? marks->decimal
                         : commas         ? ','
                                          : '.';
    if (commas + points == 1 && at[last] != decimal && !(marks->grouped && in_doubt(at, length, last))) return false;
    for (size_t k = 0; k < length; k++) {
        if (is_digit(at[k])) plain[n++] = at[k];
        else if (at[k] == decimal) plain[n++] = '.';
        else if (at[k] == '.' || at[k] == ',') { /* thousands: three digits follow */ size_t digits = 0;
            while (is_digit(at[k + 1 + digits])) digits++;
            if (digits != 3) return false;
        }
    }
    at += length;
    const size_t signs = (at[0] == 'e' || at[0] == 'E') && (at[1] == '-' || at[1] == '+');
    if ((at[0] == 'e' || at[0] == 'E') && is_digit(at[1 + signs])) {
        plain[n++] = *at++;
        for (size_t k = 0; k < signs || (is_digit(*at) && k < 6); k++) plain[n++] = *at++;
    }
    plain[n] = '\0';
    char *stop;
    *value = strtod(plain, &stop);
    *end = at;
    return *stop == '\0' && !is_digit(*at);
}

int sheet_unit(const char *text, char *dimension, double *si) {
    char folded[40];
    while (*text == ' ') text++;
    if (!*text) return 0;
    fold(text, folded, sizeof folded, true);
    return unit_of(folded, dimension, si) ? 1 : -1;
}

int sheet_refuse_columns(char *message, int size, const char *path, const char *what, const char *name,
                         const char *const *names, int n) {
    int at = snprintf(message, (size_t)size, "%s: %s%s; the columns are ", path, what, name);
    for (int k = 0, first = 1; k < n && at >= 0 && at < size; k++) {
        if (!*names[k]) continue;
        at += snprintf(message + at, (size_t)(size - at), "%s'%.50s'", first ? "" : ", ", names[k]);
        first = 0;
    }
    return clean(message);
}
