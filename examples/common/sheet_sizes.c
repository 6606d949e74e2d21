#define _POSIX_C_SOURCE 200809L
/* sheet_sizes.c: sieves and classes of a laboratory table as what passes each size; see sheet.h */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "input.h"
#include "sheet.h"
#include "sheet_words.h"

typedef enum column_kind {
    NONE,
    SIZE,
    LOW,
    HIGH,
    PHI,
    MESH,
    FINER,
    COARSER,
    RETAINED,
    SHARE,
    MASS,
    GROSS,
    TARE,
    CUM,
    DEVIATION
} column_kind;

static const char *const kind_text[] = {"",
                                        "",
                                        "",
                                        "",
                                        "",
                                        "",
                                        "share finer",
                                        "share coarser",
                                        "share on each sieve",
                                        "share of each size",
                                        "mass on each sieve",
                                        "gross less tare",
                                        "",
                                        "cumulative share",
                                        ""};

typedef struct amount {
    column_kind kind;
    int column, tare; /* -1: none */
    sheet_heading heading;
    const char *name;
    bool plain; /* its heading is the name alone: shares, unless all are whole numbers */
} amount;

/* What the columns are. */
typedef struct layout {
    int size, low, high, phi, mesh; /* columns, or -1 */
    sheet_heading size_heading, low_heading, high_heading;
    unsigned mesh_bits;
    bool size_is_class;
    amount amount[SHEET_AMOUNTS];
    int amounts;
    char twice[40]; /* what several columns may be */
} layout;

/* A row: a sieve (low == high) or a class. */
typedef struct sieve_row {
    double low, high, value[SHEET_AMOUNTS];
    int line, row;
    bool pan, less, more; /* the pan; "< 63"; "> 63" */
} sieve_row;

/* ---- headings ---- */

static unsigned bits_of(const sheet_heading *h, const char *skip) {
    unsigned bits = h->percent ? WORD_PERCENT : 0u;
    for (int k = 0; k < h->n; k++) {
        unsigned found = 0;
        if (skip && sheet_is_word(skip, h->words[k])) continue;
        for (size_t w = 0; w < sizeof sheet_sieve_words / sizeof *sheet_sieve_words; w++)
            if (sheet_is_word(sheet_sieve_words[w].words, h->words[k])) found |= sheet_sieve_words[w].bit;
        bits |= found ? found : WORD_UNKNOWN;
    }
    return bits;
}

static column_kind kind_of(const sheet_heading *h, unsigned b) {
    const bool of_mass = h->dimension == 'M' ||
                         ((b & WORD_MASS) && h->dimension != 's' && !(b & (WORD_PERCENT | WORD_SHARE | WORD_FRACTION)));
    const bool share = h->dimension == 's' || (b & (WORD_SHARE | WORD_PERCENT)) ||
                       ((b & WORD_FRACTION) && (b & (WORD_MASS | WORD_VOLUME | WORD_NUMBER)));
    if ((b & WORD_UNKNOWN) || (h->dimension && !strchr("sLM", h->dimension))) return NONE;
    if (b & WORD_PHI) return PHI;
    if (h->dimension == 'L') return b & WORD_LOW ? LOW : b & WORD_HIGH ? HIGH : SIZE;
    if (of_mass) {
        if (b & WORD_CUM) return b & (WORD_RETAINED | WORD_COARSER) ? COARSER : NONE;
        if (b & (WORD_FINER | WORD_COARSER)) return NONE;
        if (b & WORD_RETAINED) return MASS;
        if ((b & WORD_GROSS) || ((b & WORD_SIEVE) && (b & WORD_SOIL))) return GROSS;
        return (b & WORD_TARE) || (b & WORD_SIEVE) ? TARE : MASS;
    }
    if ((b & WORD_FINER) && (b & WORD_COARSER)) return NONE;
    if (b & WORD_FINER) return FINER;
    if ((b & WORD_COARSER) || ((b & WORD_CUM) && (b & WORD_RETAINED))) return COARSER;
    if (b & WORD_RETAINED) return RETAINED;
    if ((b & WORD_CUM) && !(b & (WORD_SIZE | WORD_SIEVE))) return CUM;
    if (share) return SHARE;
    if (b & WORD_LOW) return LOW;
    if (b & WORD_HIGH) return HIGH;
    if (!(b & WORD_SIZE) && ((b & (WORD_MESH | WORD_ASTM | WORD_TYLER)) || ((b & WORD_SIEVE) && (b & WORD_NUMBER))))
        return MESH;
    if (b & (WORD_SIZE | WORD_SIEVE | WORD_CLASS | WORD_FRACTION | WORD_GRAIN)) return SIZE;
    return NONE;
}

/* Is the heading that of amounts "feed" or of their deviations "feed_sd"? *unfit: it is one of deviations, but with
   other words or a unit that is none of amounts. */
static bool is_amount_of(const char *name, const sheet_heading *h, column_kind *kind, bool *unfit) {
    char base[40], skip[200];
    const size_t n = strlen(name);
    const bool wanted = n > 3 && strcmp(name + n - 3, "_sd") == 0;
    bool named = false, deviates = false;
    snprintf(base, sizeof base, "%.*s", (int)(wanted ? n - 3 : n), name);
    snprintf(skip, sizeof skip, "%.150s sd stdev standardabweichung", sheet_words_of(base));
    for (int k = 0; k < h->n; k++) {
        named |= sheet_is_word(sheet_words_of(base), h->words[k]);
        deviates |= sheet_is_word("sd stdev standardabweichung", h->words[k]);
    }
    const unsigned bits = bits_of(h, skip);
    if (!named || deviates != wanted) return false;
    const bool fits = !(bits & WORD_UNKNOWN) && (!wanted || !h->dimension || strchr("sM", h->dimension));
    *unfit |= wanted && !fits;
    if (!fits) return false;
    *kind = wanted ? DEVIATION : kind_of(h, bits);
    if (*kind < FINER) *kind = NONE;
    return wanted || *kind != NONE || bits == (bits & (WORD_NOTHING | WORD_SHARE));
}

/* Takes a column for a place if it is better than what is there: 1 taken, 0 not, -1 there are two. */
static int take(int *place, int column, bool better) {
    if (*place >= 0 && !better) return -1;
    *place = column;
    return 1;
}

/* 0: all there is; else what is missing or twice. */
static const char *find_layout(const char *const *names, int n, const char *const *wanted, int wants, layout *l) {
    static const layout empty;
    const char *twice = NULL;
    int by_kind[DEVIATION + 1];
    sheet_heading by_heading[DEVIATION + 1];
    bool has_unit = false, unfit[SHEET_AMOUNTS] = {false};
    *l = empty;
    l->size = l->low = l->high = l->phi = l->mesh = -1;
    l->amounts = wanted ? wants : 1;
    for (int j = 0; j < SHEET_AMOUNTS; j++)
        l->amount[j].column = l->amount[j].tare = -1, l->amount[j].name = wanted && j < wants ? wanted[j] : "";
    for (int k = 0; k <= DEVIATION; k++) by_kind[k] = -1;
    for (int k = 0; k < n; k++) {
        sheet_heading h;
        column_kind kind = NONE;
        bool named = false;
        sheet_read_heading(names[k], &h);
        for (int j = 0; wanted && j < wants; j++) {
            if (!is_amount_of(wanted[j], &h, &kind, &unfit[j])) continue;
            if (l->amount[j].column >= 0) twice = wanted[j];
            l->amount[j].column = k, l->amount[j].kind = kind, l->amount[j].heading = h, named = true;
        }
        if (named || !*names[k]) continue;
        const unsigned bits = bits_of(&h, NULL);
        kind = kind_of(&h, bits);
        if (kind == SIZE) {
            const bool unit = h.dimension == 'L';
            if (l->size >= 0 && has_unit == unit) twice = "sizes";
            if (l->size >= 0 && has_unit) continue;
            l->size = k, l->size_heading = h, has_unit = unit;
            l->size_is_class = bits & (WORD_CLASS | WORD_FRACTION);
        } else if (kind == LOW && take(&l->low, k, false) < 0) twice = "the lower limit";
        else if (kind == HIGH && take(&l->high, k, false) < 0) twice = "the upper limit";
        else if (kind == PHI && take(&l->phi, k, false) < 0) twice = "phi";
        else if (kind == MESH) {
            const bool better = (bits & WORD_ASTM) && !(l->mesh_bits & WORD_ASTM);
            if (l->mesh < 0 || better) l->mesh = k, l->mesh_bits = bits;
        } else if (kind >= FINER && !wanted) {
            if (by_kind[kind] >= 0) twice = kind_text[kind];
            by_kind[kind] = k, by_heading[kind] = h;
        }
        if (kind == LOW) l->low_heading = h;
        if (kind == HIGH) l->high_heading = h;
    }
    if (l->low < 0 || l->high < 0) { /* an end alone is a sieve */
        if (l->size < 0 && l->low >= 0) l->size = l->low, l->size_heading = l->low_heading;
        if (l->size < 0 && l->high >= 0) l->size = l->high, l->size_heading = l->high_heading;
        l->low = l->high = -1;
    }
    if (l->low < 0 && l->size < 0 && l->phi < 0 && l->mesh < 0) return "size";
    if (!wanted) {
        static const column_kind order[] = {FINER, COARSER, RETAINED, MASS, GROSS, SHARE, CUM};
        amount *a = &l->amount[0];
        for (size_t k = 0; k < sizeof order / sizeof *order && a->column < 0; k++) {
            const column_kind kind = order[k];
            if (by_kind[kind] < 0 || (kind == GROSS && by_kind[TARE] < 0)) continue;
            a->kind = kind, a->column = by_kind[kind], a->heading = by_heading[kind];
            a->tare = kind == GROSS ? by_kind[TARE] : -1;
        }
        if (a->column < 0) return "passing, coarser, retained, mass or share";
        if (twice && strcmp(twice, kind_text[a->kind]) != 0 && strcmp(twice, "sizes") != 0) twice = NULL;
    }
    for (int j = 0; j < l->amounts; j++)
        if (l->amount[j].column < 0 && (unfit[j] || !(wanted && strstr(wanted[j], "_sd")))) return wanted[j];
    if (twice) snprintf(l->twice, sizeof l->twice, "%s", twice);
    return twice ? l->twice : NULL;
}

/* ---- cells ---- */

static double mesh_width(const sheet_mesh *table, size_t n, double number) {
    for (size_t k = 0; k < n; k++)
        if (fabs(table[k].number - number) < 1e-9) return 1e-3 * table[k].width;
    return (double)NAN;
}
static double astm_width(double number) {
    return mesh_width(sheet_astm, sizeof sheet_astm / sizeof *sheet_astm, number);
}
static double tyler_width(double number) {
    return mesh_width(sheet_tyler, sizeof sheet_tyler / sizeof *sheet_tyler, number);
}

#define INCH 0.0254 /* [m] */

static bool is_in_inches(const sheet_heading *h) { return h->dimension == 'L' && fabs(h->si - INCH) < 1e-9; }

/* A cell in small letters with a sign or word of inches? */
static bool says_inch(const char *text) {
    return strchr(text, '"') || strstr(text, "''") || strstr(text, "in") || strstr(text, "zoll");
}

/* Whole and broken inches at the beginning of a text: 1 1/2, 3/8; NaN if there is no fraction. */
static double inches(const char *text, const char **end) {
    double part[3] = {0.0, 0.0, 0.0};
    int n = 0;
    for (const char *at = text; n < 3; n++, at++) {
        size_t digits = strspn(at, "0123456789");
        if (digits == 0 || digits > 6) return (double)NAN;
        part[n] = strtod(at, NULL), at += digits;
        if (n == 0 && *at == '/') part[1] = part[0], part[0] = 0.0, n = 1;
        *end = at;
        if (*at != (n == 0 ? ' ' : '/')) break;
    }
    return n == 2 && part[2] > 0.0 ? part[0] + part[1] / part[2] : (double)NAN;
}

static bool is_any(const char *words, const char *text) {
    char word[40];
    size_t n = strcspn(text, " (.,:");
    if (n == 0 || n >= sizeof word) return false;
    memcpy(word, text, n);
    word[n] = '\0';
    return sheet_is_word(words, word);
}

/* A number and its unit [m]; si 0: it has none. inch: it may be a fraction. */
static bool read_length(const char **at, const sheet_marks *marks, bool inch, double *size, double *si) {
    static const char *const units[] = {"mm",     "um",   "cm",  "nm", "microns", "micron", "m",
                                        "inches", "inch", "in.", "in", "zoll",    "\"",     "''"};
    static const double factors[] = {1e-3, 1e-6, 1e-2, 1e-9, 1e-6, 1e-6, 1.0, INCH, INCH, INCH, INCH, INCH, INCH, INCH};
    const char *end;
    const double broken = inch ? inches(*at, &end) : (double)NAN;
    if (!isnan(broken)) *size = broken, *at = end;
    else if (!sheet_scan(*at, marks, size, at)) return false;
    while (**at == ' ') ++*at;
    *si = isnan(broken) ? 0.0 : INCH;
    for (size_t k = 0; k < sizeof units / sizeof *units; k++) {
        const size_t n = strlen(units[k]);
        if (strncmp(*at, units[k], n) != 0 || ((*at)[n] >= 'a' && (*at)[n] <= 'z')) continue;
        *si = factors[k], *at += n;
        break;
    }
    while (**at == ' ') ++*at;
    return true;
}

/* A cell of sizes: a sieve, a class, "< x", "> x", the pan. factor: of a number without a unit; bare: set where a
   number had none. */
static bool read_size(const char *cell, const sheet_marks *marks, double factor, bool inch, sieve_row *row,
                      bool *bare) {
    static const char *const words[] = {"bis ", "to ", "...", "..", "-", "/", "and ", "und ", "+"};
    char text[80];
    const char *at = text, *end;
    bool second = false;
    double x, y = 0.0, si[2] = {0.0, 0.0};
    sheet_fold(cell, text, sizeof text);
    while (*at == ' ') at++;
    row->pan = is_any(sheet_pan_words, at);
    if (row->pan) return true;
    row->less = *at == '<' || is_any(" less below under unter smaller kleiner minus ", at);
    row->more = *at == '>' || *at == '+' || is_any(" above over ueber larger groesser ", at);
    const bool passed = *at == '-'; /* -125+63, or -63 alone */
    if (row->less || row->more || passed) {
        at += strcspn(at, "0123456789");
        if (!*at) return false;
    }
    inch |= says_inch(at);
    if (!read_length(&at, marks, inch, &x, &si[0])) return false;
    const bool whole = si[0] == 0.0;
    for (size_t k = 0; *at && k < sizeof words / sizeof *words; k++) {
        if (strncmp(at, words[k], strlen(words[k])) != 0) continue;
        const char sign = *at;
        at += strlen(words[k]);
        while (*at == ' ') at++;
        const bool broken = inch && !isnan(inches(at, &end));
        if (inch && (sign == '/' || (sign == '-' && whole && x > 0.0 && broken)))
            return false; /* 1-1/2: a class, or 1 1/2? */
        if (!read_length(&at, marks, inch, &y, &si[1])) return false;
        second = true;
        break;
    }
    if (*at) return false;
    *bare |= si[0] == 0.0 && si[1] == 0.0;
    x *= si[0] > 0.0 ? si[0] : si[1] > 0.0 ? si[1] : factor; /* a unit behind one of two numbers holds for both */
    y *= si[1] > 0.0 ? si[1] : si[0] > 0.0 ? si[0] : factor;
    row->low = row->high = x;
    if (second) {
        row->low = fmin(x, y), row->high = fmax(x, y);
        row->less = row->more = false;
    } else if (passed) row->less = true;
    return x >= 0.0 && isfinite(x) && isfinite(row->high);
}

static bool read_mesh(const char *cell, const sheet_marks *marks, double *number) {
    char text[60];
    const char *at = text, *end;
    sheet_fold(cell, text, sizeof text);
    at += strcspn(text, "0123456789");
    if (at - text > 6 || !sheet_scan(at, marks, number, &end)) return false;
    while (*end == ' ') end++;
    return !*end || strncmp(end, "mesh", 4) == 0;
}

/* ---- rows ---- */

typedef struct reader {
    const sheet_text *text;
    const char *path;
    layout l;
    sheet_marks marks;
    const char *names[SHEET_COLUMNS];
    int columns, n;
    sieve_row *row;
    double total;               /* of the row "total"; NaN */
    bool pan, classes;          /* some row is the pan, a class */
    bool bare;                  /* some size has no unit */
    bool scaled[SHEET_AMOUNTS]; /* per cent was said */
    double all[SHEET_AMOUNTS];  /* by which shares are divided */
    char *message;
    int message_size;
} reader;

static const char *cell_of(const reader *r, int row, int column) {
    const sheet_text *t = r->text;
    return column >= 0 && column < t->first[row + 1] - t->first[row] ? t->cell[t->first[row] + column] : "";
}

static int refuse_cell(reader *r, int row, int column, const char *what) {
    return sheet_refuse(r->message, r->message_size, "%s:%d: column '%.60s': '%.60s' is %s", r->path,
                        r->text->line[row], column >= 0 && column < r->columns ? r->names[column] : "",
                        cell_of(r, row, column), what);
}

/* Mesh numbers or inches: which table? ASTM or Tyler as the heading says, else where all numbers are, or where both
   say the same. */
static int find_table(reader *r, int from, double (**width)(double)) {
    const layout *l = &r->l;
    bool astm = true, tyler = true, same = true;
    *width = l->mesh_bits & WORD_TYLER ? tyler_width : astm_width;
    if (l->mesh_bits & (WORD_ASTM | WORD_TYLER)) return 0;
    for (int k = from; k < r->text->rows; k++) {
        double number;
        const char *cell = cell_of(r, k, l->mesh);
        if (strpbrk(cell, "\"/") || !read_mesh(cell, &r->marks, &number)) continue;
        const double a = astm_width(number), t = tyler_width(number);
        astm &= !isnan(a), tyler &= !isnan(t), same &= a == t;
    }
    *width = astm ? astm_width : tyler_width;
    if (same || astm != tyler) return 0;
    return sheet_refuse(r->message, r->message_size,
                        "%s: the mesh numbers may be of ASTM or Tyler: the heading must say which", r->path);
}

/* The size of a row by whatever the table has. */
static int read_place(reader *r, int row, double (*width)(double), sieve_row *out) {
    const layout *l = &r->l;
    double x;
    const char *end;
    for (int k = r->text->first[row]; k < r->text->first[row + 1] && !out->pan; k++) {
        char text[60];
        sheet_fold(r->text->cell[k], text, sizeof text);
        out->pan = is_any(sheet_pan_words, text);
    }
    if (out->pan) return 0;
    if (l->low >= 0) {
        sieve_row high = *out;
        const char *low_cell = cell_of(r, row, l->low), *high_cell = cell_of(r, row, l->high);
        out->low = out->high = 0.0;
        if (*low_cell && strcmp(low_cell, "-") != 0 &&
            !read_size(low_cell, &r->marks, l->low_heading.si, is_in_inches(&l->low_heading), out, &r->bare))
            return refuse_cell(r, row, l->low, "no size");
        high.high = HUGE_VAL;
        if (*high_cell && strcmp(high_cell, "-") != 0 &&
            !read_size(high_cell, &r->marks, l->high_heading.si, is_in_inches(&l->high_heading), &high, &r->bare))
            return refuse_cell(r, row, l->high, "no size");
        out->high = high.high, out->less = out->more = false;
        r->classes = true;
        return out->high > out->low ? 0 : refuse_cell(r, row, l->high, "not above the lower limit");
    }
    if (l->size >= 0) {
        if (!read_size(cell_of(r, row, l->size), &r->marks, l->size_heading.si, is_in_inches(&l->size_heading), out,
                       &r->bare))
            return refuse_cell(r, row, l->size, "no size");
        if (out->high > out->low) r->classes = true;
        else if (out->low == 0.0) out->pan = true; /* a sieve of width 0 */
        return 0;
    }
    if (l->phi >= 0) {
        const char *cell = cell_of(r, row, l->phi);
        if (!sheet_scan(cell, &r->marks, &x, &end) || *end || !(fabs(x) < 40.0))
            return refuse_cell(r, row, l->phi, "no phi");
        out->low = out->high = 1e-3 * pow(2.0, -x);
        return 0;
    }
    const char *cell = cell_of(r, row, l->mesh);
    bool unused = false;
    char folded[60];
    sheet_fold(cell, folded, sizeof folded);
    if (strchr(folded, '/') || says_inch(folded)) {
        if (!read_size(cell, &r->marks, INCH, true, out, &unused)) return refuse_cell(r, row, l->mesh, "no sieve");
        return 0;
    }
    if (!read_mesh(cell, &r->marks, &x)) return refuse_cell(r, row, l->mesh, "no mesh number");
    out->low = out->high = width(x);
    return isnan(out->low)
               ? refuse_cell(r, row, l->mesh, width == astm_width ? "no sieve of ASTM E11" : "no sieve of Tyler")
               : 0;
}

static int read_amount(reader *r, int row, int column, int j, double *value) {
    const char *cell = cell_of(r, row, column), *end;
    char dimension = 0;
    double si = 1.0;
    const sheet_heading *h = &r->l.amount[j].heading;
    *value = 0.0;
    if (!*cell || strcmp(cell, "-") == 0) return 0;
    const int unit = sheet_scan(cell, &r->marks, value, &end) ? sheet_unit(end, &dimension, &si) : -1;
    if (unit < 0 || (unit > 0 && dimension != 's' && dimension != 'M'))
        return refuse_cell(r, row, column, "not a number");
    if (unit > 0 && dimension == 's' && si < 1.0) r->scaled[j] = true;
    *value *= unit > 0 ? si : h->si;
    return *value >= 0.0 || r->l.amount[j].kind == DEVIATION ? 0 : refuse_cell(r, row, column, "below 0");
}

/* Sizes without a unit that exceed 1: a column of mesh numbers beside them tells it; else it must be said. */
static int find_unit(reader *r, double (*width)(double)) {
    double largest = 0.0, factor = 0.0;
    int at = 0;
    for (int k = 0; k < r->n; k++)
        if (!r->row[k].pan && r->row[k].low > largest) largest = r->row[k].low, at = k;
    const sheet_heading *h = r->l.low >= 0 ? &r->l.low_heading : &r->l.size_heading;
    if (!r->bare || r->l.phi >= 0 || (r->l.size < 0 && r->l.low < 0) || h->dimension || !(largest > 0.5)) return 0;
    for (int k = 0; k < r->n && r->l.mesh >= 0; k++) {
        double number;
        if (r->row[k].pan || !read_mesh(cell_of(r, r->row[k].row, r->l.mesh), &r->marks, &number) ||
            !(width(number) > 0.0))
            continue;
        const double ratio = width(number) / r->row[k].low, here = fabs(ratio / 1e-3 - 1.0) < 0.06   ? 1e-3
                                                                   : fabs(ratio / 1e-6 - 1.0) < 0.06 ? 1e-6
                                                                                                     : -1.0;
        factor = factor == 0.0 || factor == here ? here : -1.0;
    }
    if (factor > 0.0) {
        for (int k = 0; k < r->n; k++) r->row[k].low *= factor, r->row[k].high *= factor;
        return 0;
    }
    if (largest <= 1.0) return 0;
    return sheet_refuse(r->message, r->message_size,
                        "%s:%d: a size of %g of what? The column must name its unit, such as size_mm", r->path,
                        r->row[at].line, largest);
}

static int read_rows(reader *r, int from) {
    const layout *l = &r->l;
    double (*width)(double) = astm_width;
    if (l->mesh >= 0 && find_table(r, from, &width)) return -1;
    for (int k = from; k < r->text->rows; k++) {
        sieve_row *row = &r->row[r->n];
        const sheet_text *t = r->text;
        memset(row, 0, sizeof *row);
        row->line = t->line[k], row->row = k;
        bool empty = true;
        const bool total = sheet_is_total(t, k);
        for (int c = 0; c < t->first[k + 1] - t->first[k]; c++) {
            empty &= !*t->cell[t->first[k] + c];
            if (c >= r->columns && *t->cell[t->first[k] + c])
                return sheet_refuse(r->message, r->message_size, "%s:%d: %d cells, but the heading names %d%s", r->path,
                                    row->line, t->first[k + 1] - t->first[k], r->columns,
                                    t->separator == ',' ? ": decimal commas need semicolons or tabs between cells"
                                                        : "");
        }
        if (empty) continue;
        for (int j = 0; j < l->amounts; j++) {
            double tare = 0.0;
            if (l->amount[j].column < 0) continue;
            if (total && !*cell_of(r, k, l->amount[j].column)) continue;
            if (read_amount(r, k, l->amount[j].column, j, &row->value[j]) ||
                (l->amount[j].tare >= 0 && read_amount(r, k, l->amount[j].tare, j, &tare)))
                return -1;
            row->value[j] -= tare;
            if (row->value[j] < 0.0) return refuse_cell(r, k, l->amount[j].column, "less than the empty sieve");
            if (total && l->amount[j].kind == MASS) r->total = row->value[j];
        }
        if (total) continue;
        if (read_place(r, k, width, row)) return -1;
        r->pan |= row->pan;
        r->n++;
    }
    if (r->n == 0) return sheet_refuse(r->message, r->message_size, "%s: no rows below the heading", r->path);
    return find_unit(r, width);
}

/* ---- what passes ---- */

static int by_size(const void *a, const void *b) {
    const sieve_row *p = (const sieve_row *)a, *q = (const sieve_row *)b;
    if (p->pan != q->pan) return p->pan ? -1 : 1;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    return (p->high > q->high) - (p->high < q->high);
}

static bool rises(const reader *r, int j) {
    for (int k = 1; k < r->n; k++)
        if (!r->row[k - 1].pan && r->row[k].value[j] < r->row[k - 1].value[j]) return false;
    return true;
}
static bool falls(const reader *r, int j) {
    for (int k = 1; k < r->n; k++)
        if (r->row[k].value[j] > r->row[k - 1].value[j]) return false;
    return true;
}

static int refuse_amount(const reader *r, int j, const char *why) {
    return sheet_refuse(r->message, r->message_size, "%s: column '%.60s': %s", r->path, r->names[r->l.amount[j].column],
                        why);
}

/* Per cent although nothing says so? */
static void scale_shares(reader *r, int j, double most) {
    if (r->l.amount[j].heading.si != 1.0 || r->scaled[j] || !(most > 1.5)) return;
    for (int k = 0; k < r->n; k++) r->row[k].value[j] *= 0.01;
}

/* What an amount is where its heading leaves it open. Share on each sieve: adds up to 1; cumulated: falls
   as sizes rise. */
static int settle_kind(reader *r, int j) {
    amount *a = &r->l.amount[j];
    double sum = 0.0, most = 0.0;
    for (int k = 0; k < r->n; k++) sum += r->row[k].value[j], most = fmax(most, r->row[k].value[j]);
    a->plain = a->kind == NONE;
    if (a->plain) /* feed, coarse, fine without a word */
        a->kind =
            r->classes || r->pan ? RETAINED
            : rises(r, j) && most > 0.0 && fabs(r->row[r->n - 1].value[j] / (most > 1.5 ? 100.0 : 1.0) - 1.0) < 0.01
                ? FINER
                : SHARE;
    for (int k = 0; k < a->heading.n && a->kind == SHARE && !r->classes && !r->pan; k++)
        if (sheet_is_word("q3 q0", a->heading.words[k]) && rises(r, j) && sum > 1.03 * most &&
            fabs(most * a->heading.si / (most > 1.5 ? 100.0 : 1.0) - 1.0) < 0.01)
            a->kind = FINER; /* q3 for Q3 */
    if (a->kind == SHARE && (r->classes || r->pan)) a->kind = RETAINED;
    if (a->kind == CUM) {
        if (rises(r, j) == falls(r, j))
            return refuse_amount(r, j, "cumulated, but it neither rises nor falls with the size");
        a->kind = rises(r, j) ? FINER : COARSER;
    }
    if (a->heading.dimension == 'M' && a->kind != MASS && a->kind != GROSS && a->kind != COARSER &&
        a->kind != DEVIATION)
        a->kind = MASS;
    if (a->kind != RETAINED || r->classes) {
        if (a->kind == FINER || (a->kind == COARSER && a->heading.dimension != 'M')) scale_shares(r, j, most);
        return 0;
    }
    scale_shares(r, j, sum);
    sum = 0.0;
    for (int k = 0; k < r->n; k++) sum += r->row[k].value[j];
    if (fabs(sum - 1.0) <= (r->pan ? 0.03 : 0.01)) return 0;
    if (falls(r, j) && sum > 1.03) {
        a->kind = COARSER;
        return 0;
    }
    if (!falls(r, j) && sum < 1.0) return 0; /* the rest is in the pan, which is not there */
    return refuse_amount(
        r, j,
        falls(r, j) ? "on each sieve, or cumulated? The heading must say cumulative, or there must be a row for the pan"
                    : "neither adds up to 100 % nor falls as sizes rise; masses need a unit, such as retained_g");
}

/* Deviations of shares stand at the upper end of their class. */
static void place_deviations(const reader *r, int j, sheet_sizes *out) {
    const amount *a = &r->l.amount[j];
    const size_t n = strlen(a->name) - 3;
    double factor = 1.0;
    for (int q = 0; q < r->l.amounts; q++) {
        const amount *b = &r->l.amount[q];
        if (b->column < 0 || strncmp(b->name, a->name, n) != 0 || strlen(b->name) != n) continue;
        factor = (a->heading.dimension ? 1.0 : b->heading.si) / r->all[q];
    }
    for (int k = 0; k < out->n; k++) out->amount[j][k] = (double)NAN;
    for (int k = 0; k < r->n; k++)
        for (int i = 0; i < out->n; i++) {
            const bool here = r->classes      ? out->size[i] == r->row[k].high
                              : r->row[k].pan ? i == 0
                                              : i > 0 && out->size[i - 1] == r->row[k].low;
            if (here) out->amount[j][i] = factor * r->row[k].value[j];
        }
    out->above[j] = 0.0;
}

/* Whether columns that are named alone (feed, coarse, fine) are parts or counts: none has fractions, none adds up to
   100. */
static bool are_counts(const reader *r) {
    bool counts = true;
    for (int j = 0; j < r->l.amounts; j++) {
        double all = 0.0;
        if (r->l.amount[j].column < 0 || !r->l.amount[j].plain) continue;
        for (int k = 0; k < r->n; k++)
            all += r->row[k].value[j], counts &= r->row[k].value[j] == floor(r->row[k].value[j]);
        counts &= fabs(all - 100.0) > 3.0;
    }
    return counts;
}

/* Shares of classes or of single sizes must be a whole: else they are cumulated, or some are missing. Without a unit,
   whole numbers may be parts or counts, if they do not rise to 100. */
static int check_whole(const reader *r, int j, double all) {
    const amount *a = &r->l.amount[j];
    const bool single = a->kind == SHARE;
    const double last = r->row[r->n - 1].value[j];
    double most = 0.0;
    bool whole = true;
    for (int k = 0; k < r->n; k++) {
        const double v = r->row[k].value[j];
        most = fmax(most, v), whole &= v == floor(v);
    }
    const bool said = a->heading.dimension == 's' || r->scaled[j];
    const double unit = a->heading.si == 1.0 && !r->scaled[j] && most > 1.5 ? 100.0 : 1.0;
    const bool curve = rises(r, j) && r->row[0].value[j] < last && fabs(last / unit - 1.0) < 0.01 && all / unit > 1.03;
    const bool share = a->plain || (bits_of(&a->heading, NULL) & (WORD_SHARE | WORD_FRACTION));
    if (!said && (!share || (whole && !curve && (!a->plain || are_counts(r))))) return 0;
    if (fabs(all / unit - 1.0) <= 0.03) return 0;
    return sheet_refuse(r->message, r->message_size, "%s: column '%.60s' adds up to %.4g %%, not to 100%s", r->path,
                        r->names[a->column], 100.0 * all / unit,
                        single && curve ? "; a curve says so, such as passing or cumulative" : "");
}

/* The amount of a row in what passes the sizes above it. */
static int sum_up(reader *r, int j, sheet_sizes *out) {
    const amount *a = &r->l.amount[j];
    double all = 0.0, *passing = out->amount[j], sum = 0.0;
    int n = 0;
    const bool shares = a->kind == RETAINED || a->kind == MASS || a->kind == GROSS;
    for (int k = 0; k < r->n; k++) all += r->row[k].value[j];
    if (((a->kind == RETAINED && r->classes) || a->kind == SHARE) && all > 0.0 && check_whole(r, j, all)) return -1;
    if (a->kind == DEVIATION) {
        place_deviations(r, j, out);
        return 0;
    }
    if (shares) {
        if (!(all > 0.0)) return refuse_amount(r, j, "all amounts are 0");
        if (a->kind == MASS && fabs(all - r->total) > 0.02 * all)
            return sheet_refuse(r->message, r->message_size,
                                "%s: the rows of '%.60s' add up to %g kg, the row of the total says %g kg", r->path,
                                r->names[a->column], all, r->total);
        if (a->kind == RETAINED && !r->pan && all < 0.99 && !r->classes) sum = 1.0 - all, all = 1.0;
    }
    if (a->kind == COARSER && a->heading.dimension == 'M') {
        if (!r->pan) return refuse_amount(r, j, "cumulated masses need a row for the pan");
        all = r->row[0].value[j];
    } else if (!shares) all = 1.0;
    r->all[j] = all;
    for (int k = 0; k < r->n; k++) {
        const sieve_row *row = &r->row[k];
        const double v = row->value[j];
        if (a->kind == FINER || a->kind == COARSER) {
            if (row->pan && v > 0.0 && a->kind == FINER) return refuse_amount(r, j, "something is finer than 0");
            if (row->pan) continue;
            passing[n++] = a->kind == FINER ? v : 1.0 - v / all;
            continue;
        }
        if (a->kind == SHARE) {
            passing[n++] = v;
            continue;
        }
        if (r->classes) {
            if (k == 0 && row->low > 0.0) passing[n++] = 0.0;
            sum += v;
            if (row->high < HUGE_VAL) passing[n++] = sum / all;
        } else {
            if (!row->pan) passing[n++] = sum / all;
            sum += v;
        }
    }
    out->above[j] = a->kind == SHARE ? 0.0 : 1.0 - passing[out->n - 1];
    if (fabs(out->above[j]) < 1e-12) out->above[j] = 0.0;
    if (shares && out->above[j] == 0.0) passing[out->n - 1] = 1.0;
    if (a->kind == SHARE) return 0;
    for (int k = 0; k < out->n; k++) {
        if (!(passing[k] >= -1e-9 && passing[k] <= 1.0 + 1e-3))
            return sheet_refuse(
                r->message, r->message_size,
                "%s:%d: column '%.60s': %g of the whole is finer than %g mm; it is 0 to 1, or 0 to 100 %%", r->path,
                out->line[k], r->names[a->column], passing[k], 1e3 * out->size[k]);
        passing[k] = fmin(fmax(passing[k], 0.0), 1.0); /* what per cents were rounded to */
        if (k > 0 && passing[k] < passing[k - 1] - 1e-9)
            return sheet_refuse(r->message, r->message_size,
                                "%s:%d: column '%.60s': less is finer than %g mm (%g) than %g mm (%g)", r->path,
                                out->line[k], r->names[a->column], 1e3 * out->size[k], passing[k],
                                1e3 * out->size[k - 1], passing[k - 1]);
    }
    return 0;
}

/* Sizes from the sorted rows; lines of classes are those of the class below the size. */
static int find_sizes(reader *r, sheet_sizes *out) {
    const column_kind kind = r->l.amount[0].kind;
    const bool cumulated = kind == FINER || kind == COARSER;
    out->n = 0;
    for (int k = 0; k < r->n; k++) {
        const sieve_row *row = &r->row[k];
        if (row->pan && !r->classes) continue;
        if (r->classes && !cumulated) {
            const double before = k ? r->row[k - 1].high : row->low;
            if (fabs(row->low - before) > 1e-6 * before)
                return sheet_refuse(r->message, r->message_size,
                                    "%s:%d: the class from %g mm does not begin where the one below ends, at %g mm",
                                    r->path, row->line, 1e3 * row->low, 1e3 * before);
            if (k == 0 && row->low > 0.0) out->line[out->n] = row->line, out->size[out->n++] = row->low;
            if (row->high < HUGE_VAL) out->line[out->n] = row->line, out->size[out->n++] = row->high;
            else if (k < r->n - 1)
                return sheet_refuse(r->message, r->message_size, "%s:%d: two classes without an upper limit", r->path,
                                    row->line);
            continue;
        }
        const double x = kind == COARSER ? row->low : row->high;
        if (!(x > 0.0 && x < HUGE_VAL))
            return sheet_refuse(r->message, r->message_size, "%s:%d: no size", r->path, row->line);
        if (out->n && !(x > out->size[out->n - 1]))
            return sheet_refuse(r->message, r->message_size, "%s:%d: the size %g mm is there twice", r->path, row->line,
                                1e3 * x);
        out->line[out->n] = row->line, out->size[out->n++] = x;
    }
    return out->n ? 0 : sheet_refuse(r->message, r->message_size, "%s: no sizes", r->path);
}

/* Turns "< 63", "> 63" and the pan into what they are in this table. */
static void settle_ends(reader *r) {
    const column_kind kind = r->l.amount[0].kind;
    const bool cumulated = kind == FINER || kind == COARSER || kind == CUM;
    double least = HUGE_VAL;
    for (int k = 0; k < r->n; k++)
        if (!r->row[k].pan && !r->row[k].less) least = fmin(least, r->row[k].low);
    for (int k = 0; k < r->n && !cumulated; k++) {
        sieve_row *row = &r->row[k];
        if (r->classes) {
            if (row->pan) row->pan = false, row->low = 0.0, row->high = least;
            else if (row->less) row->low = 0.0;
            else if (row->more || row->low == row->high) row->high = HUGE_VAL;
        } else if (row->less && row->low <= least) row->pan = true, r->pan = true;
    }
    if (r->classes) r->pan = false;
}

static void say_how(const reader *r, bool top_down, sheet_sizes *out) {
    const amount *a = &r->l.amount[0];
    const layout *l = &r->l;
    const int size = (int)sizeof out->how, place = l->low >= 0    ? l->low
                                                   : l->size >= 0 ? l->size
                                                   : l->phi >= 0  ? l->phi
                                                                  : l->mesh;
    const char *what = out->single ? "share" : "finer";
    char said[SHEET_MARKS];
    int at = snprintf(out->how, (size_t)size, "%.150s: %s%s of '%.40s' by '%.40s', %s%s", r->path,
                      sheet_marks_text(r->text, &r->marks, said), kind_text[a->kind], r->names[a->column],
                      r->names[place], r->classes ? "classes, " : "", top_down ? "top-down" : "bottom-up");
    for (int j = 1; j < l->amounts && at >= 0 && at < size; j++)
        if (l->amount[j].column >= 0)
            at += snprintf(out->how + at, (size_t)(size - at), ", '%.40s'", r->names[l->amount[j].column]);
    if (at >= 0 && at < size)
        at += snprintf(out->how + at, (size_t)(size - at), "; %s %.6g at %.6g m ... %.6g at %.6g m", what,
                       out->amount[0][0], out->size[0], out->amount[0][out->n - 1], out->size[out->n - 1]);
    if (at >= 0 && at < size && out->above[0] > 1e-3)
        snprintf(out->how + at, (size_t)(size - at), "; %.4g are coarser", out->above[0]);
}

void sheet_free_sizes(sheet_sizes *s) {
    static const sheet_sizes empty;
    free(s->memory);
    *s = empty;
}

/* Room for the rows of the reader and what comes out. */
static bool make_room(reader *r, sheet_sizes *out, int rows) {
    const size_t n = (size_t)rows + 2;
    double *d = malloc(n * (SHEET_AMOUNTS + 2) * sizeof *d + n * sizeof *out->line + SHEET_AMOUNTS * sizeof *d);
    r->row = malloc(n * sizeof *r->row);
    out->memory = d;
    if (!d || !r->row) return false;
    out->size = d, out->above = d + n * (SHEET_AMOUNTS + 1), out->line = (int *)(void *)(out->above + SHEET_AMOUNTS);
    for (int j = 0; j < SHEET_AMOUNTS; j++)
        out->amount[j] = j < r->l.amounts && r->l.amount[j].column >= 0 ? d + n * (size_t)(j + 1) : NULL;
    return true;
}

static int read_body(reader *r, int from, sheet_sizes *out) {
    int column[SHEET_AMOUNTS * 2 + 5], used = 0;
    layout *l = &r->l;
    for (int k = from; k < r->text->rows && l->size >= 0; k++) { /* "No. 4" in a column of sieves */
        char text[40];
        sheet_fold(cell_of(r, k, l->size), text, sizeof text);
        if (text[0] != '#' && !is_any(" no nr ", text) && !strstr(text, "mesh")) continue;
        if (!strstr(text, "mesh")) l->mesh_bits |= WORD_ASTM;
        l->mesh = l->size, l->size = -1;
    }
    for (int j = 0; j < l->amounts; j++) column[used++] = l->amount[j].column, column[used++] = l->amount[j].tare;
    column[used++] = l->size, column[used++] = l->low, column[used++] = l->high, column[used++] = l->phi;
    column[used++] = l->mesh;
    if (sheet_find_marks(r->text, from, column, used, r->path, &r->marks, r->message, r->message_size) ||
        read_rows(r, from))
        return -1;
    const bool top_down = r->n > 1 && !r->row[0].pan && (r->row[r->n - 1].pan || r->row[0].low > r->row[r->n - 1].low);
    settle_ends(r);
    qsort(r->row, (size_t)r->n, sizeof *r->row, by_size);
    for (int j = 0; j < l->amounts; j++)
        if (l->amount[j].column >= 0 && settle_kind(r, j)) return -1;
    for (int j = 1; j < l->amounts; j++) {
        const column_kind a = l->amount[0].kind, b = l->amount[j].kind;
        if (l->amount[j].column >= 0 && b != DEVIATION && (a == FINER || a == COARSER) != (b == FINER || b == COARSER))
            return refuse_amount(r, j, "cumulated and not: all amounts must be of one kind");
    }
    int pans = 0;
    for (int k = 0; k < r->n; k++) pans += r->row[k].pan;
    if (pans > 1) return sheet_refuse(r->message, r->message_size, "%s: more than one row is the pan", r->path);
    if (find_sizes(r, out)) return -1;
    out->single = l->amount[0].kind == SHARE;
    for (int j = 0; j < l->amounts; j++)
        if (l->amount[j].column >= 0 && sum_up(r, j, out)) return -1;
    const unsigned bits = bits_of(&l->amount[0].heading, NULL);
    out->by_number = bits & WORD_NUMBER                                                            ? 1
                     : (bits & (WORD_MASS | WORD_VOLUME)) || l->amount[0].heading.dimension == 'M' ? 0
                                                                                                   : -1;
    say_how(r, top_down, out);
    return 0;
}

int sheet_parse_sizes(const char *bytes, long size, const char *path, const char *const *names, int n, sheet_sizes *out,
                      char *message, int message_size) {
    static const sheet_sizes empty;
    static const reader fresh;
    char room[SHEET_COLUMNS * 184];
    const char *missing = "size";
    int head = 0, lines = 1, first_text = -1;
    sheet_text text;
    reader r = fresh;
    *out = empty;
    if (n > SHEET_AMOUNTS) return sheet_refuse(message, message_size, "%s: too many amounts", path);
    if (sheet_cut(bytes, size, path, &text, message, message_size)) return -1;
    r.text = &text, r.path = path, r.message = message, r.message_size = message_size, r.total = (double)NAN;
    for (int row = 0; row < text.rows && row < 60 && missing; row++)
        for (lines = sheet_heading_lines(&text, row); lines > 0; lines = lines > 1 ? 1 : 0) {
            r.columns = sheet_headings(&text, row, lines, r.names, room, sizeof room);
            missing = find_layout(r.names, r.columns, names, n, &r.l);
            head = row;
            if (first_text < 0 && r.columns > 1) first_text = row;
            if (!missing || missing == r.l.twice) break;
        }
    int failed = 0;
    if (missing) {
        if (missing != r.l.twice) {
            r.columns = sheet_headings(&text, first_text < 0 ? 0 : first_text, 1, r.names, room, sizeof room);
            missing = find_layout(r.names, r.columns, names, n, &r.l);
            if (!missing) missing = "size";
        }
        failed = sheet_refuse_columns(message, message_size, path,
                                      missing == r.l.twice ? "several columns are " : "no column ", missing, r.names,
                                      r.columns);
    } else if (!make_room(&r, out, text.rows)) failed = sheet_refuse(message, message_size, "%s: out of memory", path);
    else failed = read_body(&r, head + (lines > 1 ? 2 : 1), out);
    free(r.row);
    sheet_text_free(&text);
    if (failed) sheet_free_sizes(out);
    return failed;
}

int sheet_read_sizes(const char *path, const char *const *names, int n, sheet_sizes *out, char *message,
                     int message_size) {
    static const sheet_sizes empty;
    size_t size;
    *out = empty;
    char *bytes = input_read(path, &size, message, (size_t)message_size);
    const int status = bytes ? sheet_parse_sizes(bytes, (long)size, path, names, n, out, message, message_size) : -1;
    free(bytes);
    return status;
}
