/* fields.c: see fields.h */
#include "fields.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- units ---- */

typedef struct unit {
    unit_kind kind;
    const char *name;
    double factor;
} unit;

static const double pi = 3.14159265358979323846;

/* The first of a kind is its SI unit. */
static const unit units[] = {
    {UNIT_SHARE, "", 1.0},
    {UNIT_SHARE, "%", 0.01},
    {UNIT_LENGTH, "m", 1.0},
    {UNIT_LENGTH, "mm", 1e-3},
    {UNIT_LENGTH, "um", 1e-6},
    {UNIT_LENGTH, "cm", 1e-2},
    {UNIT_DIAMETER, "m", 1.0},
    {UNIT_DIAMETER, "mm", 1e-3},
    {UNIT_DIAMETER, "um", 1e-6},
    {UNIT_DIAMETER, "cm", 1e-2},
    {UNIT_TIME, "s", 1.0},
    {UNIT_TIME, "ms", 1e-3},
    {UNIT_TIME, "us", 1e-6},
    {UNIT_TIME, "min", 60.0},
    {UNIT_MASS, "kg", 1.0},
    {UNIT_MASS, "g", 1e-3},
    {UNIT_MASS, "t", 1e3},
    {UNIT_MASS_FLOW, "kg/s", 1.0},
    {UNIT_MASS_FLOW, "g/s", 1e-3},
    {UNIT_MASS_FLOW, "kg/h", 1.0 / 3600.0},
    {UNIT_MASS_FLOW, "t/h", 1.0 / 3.6},
    {UNIT_ANGLE, "rad", 1.0},
    {UNIT_ANGLE, "deg", 0.0},
    {UNIT_FREQUENCY, "Hz", 1.0},
    {UNIT_FREQUENCY, "1/s", 1.0},
    {UNIT_FREQUENCY, "1/min", 1.0 / 60.0},
    {UNIT_FREQUENCY, "rpm", 1.0 / 60.0},
    {UNIT_SPIN, "rad/s", 1.0},
    {UNIT_SPIN, "rpm", 0.0},
    {UNIT_SPIN, "1/min", 0.0},
    {UNIT_SPEED, "m/s", 1.0},
    {UNIT_SPEED, "mm/s", 1e-3},
    {UNIT_ACCELERATION, "m/s2", 1.0},
    {UNIT_STRESS, "Pa", 1.0},
    {UNIT_STRESS, "kPa", 1e3},
    {UNIT_STRESS, "MPa", 1e6},
    {UNIT_STRESS, "GPa", 1e9},
    {UNIT_DENSITY, "kg/m3", 1.0},
    {UNIT_DENSITY, "g/cm3", 1e3},
    {UNIT_DENSITY, "t/m3", 1e3},
    {UNIT_STIFFNESS, "N/m", 1.0},
    {UNIT_STIFFNESS, "N/mm", 1e3},
    {UNIT_STIFFNESS, "kN/m", 1e3},
    {UNIT_VISCOSITY, "Pa s", 1.0},
    {UNIT_VISCOSITY, "mPa s", 1e-3},
    {UNIT_TENSION, "N/m", 1.0},
    {UNIT_TENSION, "mN/m", 1e-3},
    {UNIT_TENSION, "J/m2", 1.0},
    {UNIT_TENSION, "mJ/m2", 1e-3},
    {UNIT_FORCE, "N", 1.0},
    {UNIT_FORCE, "kN", 1e3},
    {UNIT_TORQUE, "N m", 1.0},
    {UNIT_DAMPING, "N s/m", 1.0},
    {UNIT_INERTIA, "kg m2", 1.0},
};
enum { UNITS = sizeof units / sizeof *units };

static double factor_of(const unit *u) {
    if (u->factor > 0.0) return u->factor;
    return u->kind == UNIT_ANGLE ? pi / 180.0 : pi / 30.0; /* deg, rpm */
}

static bool must_name_unit(unit_kind kind, double value) {
    return ((kind == UNIT_ANGLE || kind == UNIT_SPIN) && value != 0.0) || (kind == UNIT_DIAMETER && value > 1.0);
}

/* "m, mm, um or cm" */
static const char *names_of(unit_kind kind, char *text, size_t size) {
    int n = 0, k = 0;
    size_t used = 0;
    text[0] = '\0';
    for (int u = 0; u < UNITS; u++) n += units[u].kind == kind && units[u].name[0];
    for (int u = 0; u < UNITS; u++)
        if (units[u].kind == kind && units[u].name[0] && used < size) {
            used += (size_t)snprintf(text + used, size - used, "%s%s",
                                     k == 0       ? ""
                                     : k == n - 1 ? " or "
                                                  : ", ",
                                     units[u].name);
            k++;
        }
    return text;
}

/* ---- messages ---- */

static int least_of(int a, int b) { return a < b ? a : b; }

/* How many letters must be added, dropped or changed (Levenshtein 1966); words beyond 40 letters are far from all. */
static int distance(const char *a, const char *b) {
    enum { LONGEST = 40 };
    int row[LONGEST + 1];
    const int n = (int)strlen(a), m = (int)strlen(b);
    if (n > LONGEST || m > LONGEST) return LONGEST;
    for (int j = 0; j <= m; j++) row[j] = j;
    for (int i = 1; i <= n; i++) {
        int corner = row[0];
        row[0] = i;
        for (int j = 1; j <= m; j++) {
            const int change = corner + (a[i - 1] != b[j - 1]);
            corner = row[j];
            row[j] = least_of(change, least_of(row[j], row[j - 1]) + 1);
        }
    }
    return row[m];
}

static int same_beginning(const char *a, const char *b) {
    int n = 0;
    while (a[n] && a[n] == b[n]) n++;
    return n;
}

/* The nearest of the allowed words if it is near at all, and all of them. Of two that are as near, "seed" and "feeds"
   for "feed", the one that begins alike. */
int fields_refuse_word(tree_file *file, const tree *at, const char *what, const char *word, const char *const *allowed,
                       int n) {
    char list[260] = "";
    int best = -1, nearest = 0;
    for (int k = 0; k < n; k++) {
        const int d = distance(word, allowed[k]);
        const size_t used = strlen(list);
        if (best < 0 || d < best ||
            (d == best && same_beginning(word, allowed[k]) > same_beginning(word, allowed[nearest])))
            best = d, nearest = k;
        if (used + strlen(allowed[k]) + 3 < sizeof list)
            snprintf(list + used, sizeof list - used, "%s%s", k ? ", " : "", allowed[k]);
    }
    if (best >= 0 && best <= 1 + (int)strlen(word) / 3)
        return tree_fail(file, at, "%.60s: unknown %s; the nearest is %s (%s)", word, what, allowed[nearest], list);
    return tree_fail(file, at, "%.60s: unknown %s; allowed: %s", word, what, list);
}

static int refuse_key(tree_file *file, const tree *at, const char *key, const scene_table *s) {
    const char *allowed[64];
    const int n = s->n < 64 ? s->n : 64;
    for (int k = 0; k < n; k++) allowed[k] = s->field[k].key;
    return fields_refuse_word(file, at, "key", key, allowed, n);
}

/* "0 < x <= 1 m" */
static const char *range_of(const scene_field *f, char *text, size_t size) {
    char low[30], high[30];
    snprintf(low, sizeof low, "%g", f->low);
    snprintf(high, sizeof high, "%g", f->high);
    const char *si = "";
    const bool bounded = f->high < 1e29; /* a bound that only keeps infinity out is none */
    for (int u = UNITS - 1; u >= 0; u--)
        if (units[u].kind == f->unit) si = units[u].name;
    if (f->low > -HUGE_VAL && bounded && !f->above)
        snprintf(text, size, "%s to %s%s%s", low, high, si[0] ? " " : "", si);
    else if (f->low > -HUGE_VAL && bounded)
        snprintf(text, size, "above %s, at most %s%s%s", low, high, si[0] ? " " : "", si);
    else if (f->low > -HUGE_VAL)
        snprintf(text, size, "%s %s%s%s", f->above ? "above" : "at least", low, si[0] ? " " : "", si);
    else snprintf(text, size, "any finite number");
    return text;
}

/* ---- values ---- */

static const char *kind_text[] = {"a text", "a list", "a map"};

/* A unit as it may be written, as the table has it: "µm" um, "°" deg, "kg/m³" and "kg/m^3" kg/m3, "N·m" N m. */
static void plain_unit(const char *written, char *plain, size_t size) {
    static const char *const as[][2] = {{"\302\265", "u"}, {"\316\274", "u"}, {"\302\260", "deg"}, {"\302\262", "2"},
                                        {"\302\263", "3"}, {"\302\267", " "}, {"*", " "},          {"^", ""}};
    size_t n = 0;
    while (*written && n + 4 < size) {
        size_t k = 0;
        while (k < sizeof as / sizeof *as && strncmp(written, as[k][0], strlen(as[k][0])) != 0) k++;
        if (k < sizeof as / sizeof *as) {
            n += (size_t)snprintf(plain + n, size - n, "%s", as[k][1]);
            written += strlen(as[k][0]);
        } else plain[n++] = *written++;
    }
    while (n > 0 && plain[n - 1] == ' ') n--;
    plain[n] = '\0';
}

static int same_letters(const char *a, const char *b) {
    while (*a && *b && (*a | 32) == (*b | 32)) a++, b++;
    return !*a && !*b;
}

/* The unit's place in the table, or -1. Letters may be of any case where no prefix can be mistaken for another: not
   "MPa s" for "mPa s". */
static int unit_of(unit_kind kind, const char *written) {
    char plain[40];
    plain_unit(written, plain, sizeof plain);
    for (int u = 0; u < UNITS; u++)
        if (units[u].kind == kind && strcmp(units[u].name, plain) == 0) return u;
    for (int u = 0; u < UNITS && kind != UNIT_VISCOSITY && kind != UNIT_TENSION && kind != UNIT_STRESS; u++)
        if (units[u].kind == kind && units[u].name[0] && same_letters(units[u].name, plain)) return u;
    return -1;
}

/* "6 mm" in SI units. name: of the key, for messages. */
static int read_number(tree_file *file, const tree *v, const char *name, const scene_field *f, double *number) {
    char names[120], range[120], *end;
    if (v->kind != TREE_TEXT) return tree_fail(file, v, "%s: a number is wanted, not %s", name, kind_text[v->kind]);
    const char *text = v->text;
    double value = strtod(text, &end); /* which knows more than a table of numbers should: "0x1p3", "infinity", "nan" */
    if (end == text || (int)strspn(text, "+-.0123456789eE") < end - text || strcspn(text, "0123456789") > 2) {
        if (f->unit == UNIT_NONE || f->unit == UNIT_SHARE)
            return tree_fail(file, v, "%s: '%.60s' is no number", name, text);
        return tree_fail(file, v, "%s: '%.60s' is no number (unit: %s)", name, text,
                         names_of(f->unit, names, sizeof names));
    }
    if (*end == ',' && end[1] >= '0' && end[1] <= '9')
        return tree_fail(file, v, "%s: '%.60s': a decimal point is wanted: %.*s.%.40s", name, text,
                         least_of((int)(end - text), 30), text, end + 1);
    while (*end == ' ') end++;
    if (*end == '\0') {
        if (must_name_unit(f->unit, value))
            return tree_fail(file, v, "%s: %.60s of what? It must name its unit: %s", name, text,
                             names_of(f->unit, names, sizeof names));
    } else {
        const int found = unit_of(f->unit, end);
        if (found < 0 && !names_of(f->unit, names, sizeof names)[0])
            return tree_fail(file, v, "%s: '%.60s': a plain number, without unit", name, text);
        if (found < 0) return tree_fail(file, v, "%s: unit '%.40s': allowed are %s", name, end, names);
        value *= factor_of(&units[found]);
    }
    if (value > f->high && f->high >= 1e29) return tree_fail(file, v, "%s: %.60s: too large", name, text);
    if (!(value >= f->low && value <= f->high) || (f->above && value == f->low) || !isfinite(value))
        return tree_fail(file, v, "%s: %.60s: allowed is %s", name, text, range_of(f, range, sizeof range));
    if (f->kind == FIELD_WHOLE && value != floor(value))
        return tree_fail(file, v, "%s: %.60s: a whole number is wanted", name, text);
    *number = value;
    return 0;
}

static int read_yes(tree_file *file, const tree *v, const scene_field *f, int *yes) {
    static const char *const words[] = {"no", "yes", "false", "true"};
    for (int k = 0; v->kind == TREE_TEXT && !v->quoted && k < 4; k++)
        if (strcmp(v->text, words[k]) == 0) return *yes = k % 2, 0;
    return tree_fail(file, v, "%s: yes or no", f->key);
}

static int read_text(tree_file *file, const tree *v, const scene_field *f, const char **text) {
    if (v->kind != TREE_TEXT || !v->text[0])
        return tree_fail(file, v, "%s: a text is wanted%s%s", f->key, v->kind == TREE_TEXT ? "" : ", not ",
                         v->kind == TREE_TEXT ? "" : kind_text[v->kind]);
    *text = v->text;
    return 0;
}

static int read_choice(tree_file *file, const tree *v, const scene_field *f, int *choice) {
    char words[200];
    const char *allowed[16];
    int n = 0;
    snprintf(words, sizeof words, "%s", f->choices);
    for (char *w = words; w && n < 16;) {
        char *bar = strchr(w, '|');
        if (bar) *bar = '\0';
        allowed[n++] = w;
        w = bar ? bar + 1 : NULL;
    }
    if (v->kind != TREE_TEXT) return tree_fail(file, v, "%s: a word is wanted, not %s", f->key, kind_text[v->kind]);
    for (int k = 0; k < n; k++)
        if (strcmp(allowed[k], v->text) == 0) return *choice = k, 0;
    return fields_refuse_word(file, v, f->key, v->text, allowed, n);
}

static int read_vector(tree_file *file, const tree *v, const scene_field *f, double *xyz) {
    char name[80];
    if (v->kind != TREE_LIST || v->n != 3) return tree_fail(file, v, "%s: three numbers are wanted: [x, y, z]", f->key);
    scene_field number = *f;
    /* the range of a list is that of its length */
    number.kind = FIELD_NUMBER, number.low = -HUGE_VAL, number.high = HUGE_VAL;
    for (int c = 0; c < 3; c++) {
        snprintf(name, sizeof name, "%s, %c", f->key, "xyz"[c]);
        if (read_number(file, v->item[c], name, &number, &xyz[c])) return -1;
    }
    return 0;
}

static int read_points(tree_file *file, const tree *v, const scene_field *f, scene_list *list) {
    if (v->kind != TREE_LIST) return tree_fail(file, v, "%s: a list of points is wanted, each [x, y, z]", f->key);
    if (v->n < f->low || v->n > f->high)
        return tree_fail(file, v, "%s: %d of them; allowed is %g to %g", f->key, v->n, f->low, f->high);
    double *item = tree_memory(file, 3 * sizeof *item * (size_t)(v->n ? v->n : 1));
    if (!item) return -1;
    list->n = v->n, list->item = item;
    for (int k = 0; k < v->n; k++)
        if (read_vector(file, v->item[k], f, item + 3 * k)) return -1;
    return 0;
}

/* [low, high]: how many there may be; any number of the unit above 0. */
static int read_numbers(tree_file *file, const tree *v, const scene_field *f, scene_list *list) {
    if (v->kind != TREE_LIST) return tree_fail(file, v, "%s: a list of numbers is wanted: [1 mm, 2 mm]", f->key);
    if (v->n < f->low || v->n > f->high)
        return tree_fail(file, v, "%s: %d of them; allowed is %g to %g", f->key, v->n, f->low, f->high);
    double *item = tree_memory(file, sizeof *item * (size_t)(v->n ? v->n : 1));
    if (!item) return -1;
    list->n = v->n, list->item = item;
    scene_field number = *f;
    number.kind = FIELD_NUMBER, number.low = 0.0, number.high = 1e30, number.above = true;
    for (int k = 0; k < v->n; k++)
        if (read_number(file, v->item[k], f->key, &number, &item[k])) return -1;
    return 0;
}

/* A timetable: times rise; between two the number changes evenly. */
static int read_pairs(tree_file *file, const tree *v, const scene_field *f, scene_list *list) {
    if (v->kind != TREE_LIST) return tree_fail(file, v, "%s: a list of [time, number] is wanted", f->key);
    if (v->n < f->low || v->n > f->high)
        return tree_fail(file, v, "%s: %d of them; allowed is %g to %g", f->key, v->n, f->low, f->high);
    double *item = tree_memory(file, 2 * sizeof *item * (size_t)(v->n ? v->n : 1));
    if (!item) return -1;
    list->n = v->n, list->item = item;
    scene_field time = *f, number = *f;
    time.kind = number.kind = FIELD_NUMBER, time.unit = UNIT_TIME, time.low = 0.0, time.high = 1e30, time.above = false;
    number.low = -1e30, number.high = 1e30, number.above = false;
    for (int k = 0; k < v->n; k++, item += 2) {
        const tree *pair = v->item[k];
        if (pair->kind != TREE_LIST || pair->n != 2)
            return tree_fail(file, pair, "%s: [time, number] is wanted", f->key);
        if (read_number(file, pair->item[0], f->key, &time, &item[0]) ||
            read_number(file, pair->item[1], f->key, &number, &item[1]))
            return -1;
        if (k > 0 && !(item[0] > item[-2])) return tree_fail(file, pair, "%s: times must rise", f->key);
    }
    return 0;
}

static int read_two(tree_file *file, const tree *v, const scene_field *f, const char **two) {
    if (v->kind != TREE_LIST || v->n != 2) return tree_fail(file, v, "%s: two names are wanted: [a, b]", f->key);
    return read_text(file, v->item[0], f, &two[0]) || read_text(file, v->item[1], f, &two[1]) ? -1 : 0;
}

/* Names stand in columns of CSV files. */
static int check_name(tree_file *file, const tree *key) {
    const size_t length = strlen(key->text);
    if (length >= 1 && length <= 40 &&
        strspn(key->text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.") == length)
        return 0;
    return tree_fail(file, key, "%.60s: a name has 1 to 40 letters, digits, '_', '-' or '.'", key->text);
}

static int read_list(tree_file *file, const tree *v, const scene_field *f, scene_list *list) {
    const tree_kind wanted = f->kind == FIELD_NAMED ? TREE_MAP : TREE_LIST;
    if (v->kind != wanted)
        return tree_fail(file, v,
                         wanted == TREE_MAP ? "%s: names are wanted, each with its keys"
                                            : "%s: a list is wanted, each line beginning with '-'",
                         f->key);
    if (v->n < f->low || v->n > f->high)
        return tree_fail(file, v, "%s: %d of them; allowed is %g to %g", f->key, v->n, f->low, f->high);
    char *item = tree_memory(file, f->section->size * (size_t)(v->n ? v->n : 1));
    if (!item) return -1;
    list->n = v->n, list->item = item;
    for (int k = 0; k < v->n; k++) {
        if (f->kind == FIELD_NAMED && check_name(file, v->key[k])) return -1;
        void *at = item + (size_t)k * f->section->size;
        if (fields_read(file, v->item[k], f->section, at)) return -1;
        ((scene_part *)at)->name = f->kind == FIELD_NAMED ? v->key[k]->text : NULL;
    }
    return 0;
}

static int read_value(tree_file *file, const tree *v, const scene_field *f, void *into) {
    void *at = (char *)into + f->at;
    switch (f->kind) {
    case FIELD_NUMBER:
    case FIELD_WHOLE: return read_number(file, v, f->key, f, at);
    case FIELD_YES: return read_yes(file, v, f, at);
    case FIELD_TEXT:
    case FIELD_FILE: return read_text(file, v, f, at);
    case FIELD_TWO: return read_two(file, v, f, at);
    case FIELD_CHOICE: return read_choice(file, v, f, at);
    case FIELD_VECTOR: return read_vector(file, v, f, at);
    case FIELD_POINTS: return read_points(file, v, f, at);
    case FIELD_NUMBERS: return read_numbers(file, v, f, at);
    case FIELD_PAIRS: return read_pairs(file, v, f, at);
    case FIELD_PART: return fields_read(file, v, f->section, at);
    case FIELD_LIST:
    case FIELD_NAMED: return read_list(file, v, f, at);
    }
    return -1;
}

/* ---- defaults: the table's text, read as a file's ---- */

static int set_default(tree_file *file, const scene_field *f, void *into) {
    void *at = (char *)into + f->at;
    if (f->kind == FIELD_NUMBER || f->kind == FIELD_WHOLE) *(double *)at = (double)NAN;
    if (f->kind == FIELD_VECTOR) ((double *)at)[0] = ((double *)at)[1] = ((double *)at)[2] = (double)NAN;
    if (!f->fallback || !f->fallback[0] || f->kind >= FIELD_POINTS) return 0;
    tree text = {TREE_TEXT, 0, 0, f->fallback, 0, 0, 0, 0, NULL, NULL, NULL};
    if (f->kind != FIELD_VECTOR) return read_value(file, &text, f, into);
    double *xyz = at; /* "[0, 0, 1]": only bare numbers */
    return sscanf(f->fallback, "[%lf, %lf, %lf]", &xyz[0], &xyz[1], &xyz[2]) == 3
               ? 0
               : tree_fail(file, NULL, "%s: bad default", f->key);
}

static const scene_field *field_of(const scene_table *s, const char *key) {
    for (int k = 0; k < s->n; k++)
        if (strcmp(s->field[k].key, key) == 0) return &s->field[k];
    return NULL;
}

/* Of the keys of a group exactly one: a wall has one shape, a feed one amount. */
static int check_groups(tree_file *file, const tree *map, const scene_table *s) {
    for (int group = 1, there = 1; there; group++) {
        char list[260] = "";
        int given = 0;
        there = 0;
        for (int k = 0; k < s->n; k++) {
            const scene_field *f = &s->field[k];
            if (f->group != group) continue;
            const size_t used = strlen(list);
            there = 1, given += tree_find(map, f->key) != NULL;
            if (used + strlen(f->key) + 3 < sizeof list)
                snprintf(list + used, sizeof list - used, "%s%s", used ? ", " : "", f->key);
        }
        if (there && given != 1) return tree_fail(file, map, "%s: exactly one is wanted of %s", s->title, list);
    }
    return 0;
}

int fields_read(tree_file *file, const tree *map, const scene_table *s, void *into) {
    if (map->kind != TREE_MAP)
        return tree_fail(file, map, "%s: keys with values are wanted, such as {%s: ...}, not %s", s->title,
                         s->field[0].key, kind_text[map->kind]);
    memset(into, 0, s->size);
    ((scene_part *)into)->where = map;
    for (int k = 0; k < s->n; k++)
        if (set_default(file, &s->field[k], into)) return -1;
    for (int k = 0; k < map->n; k++) {
        const scene_field *f = field_of(s, map->key[k]->text);
        if (!f) return refuse_key(file, map->key[k], map->key[k]->text, s);
        if (read_value(file, map->item[k], f, into)) return -1;
    }
    for (int k = 0; k < s->n; k++)
        if (!s->field[k].fallback && !s->field[k].group && !tree_find(map, s->field[k].key))
            return tree_fail(file, map, "%s: %s is missing", s->title, s->field[k].key);
    return check_groups(file, map, s);
}

const tree *fields_where(const scene_part *p, const char *key) {
    const tree *value = tree_find(p->where, key);
    return value ? value : p->where;
}

/* ---- the reference ---- */

static const char *type_text(const scene_field *f, char *text, size_t size) {
    char range[120], names[120];
    const char *allowed = names_of(f->unit, names, sizeof names);
    switch (f->kind) {
    case FIELD_NUMBER:
    case FIELD_WHOLE:
        snprintf(text, size, "%s%s%s; %s", f->kind == FIELD_WHOLE ? "whole number" : "number", allowed[0] ? ", " : "",
                 allowed, range_of(f, range, sizeof range));
        break;
    case FIELD_YES: snprintf(text, size, "yes, no"); break;
    case FIELD_TEXT:
    case FIELD_FILE: snprintf(text, size, "text"); break;
    case FIELD_TWO: snprintf(text, size, "[name, name]"); break;
    case FIELD_CHOICE: {
        size_t used = 0;
        for (const char *c = f->choices; *c && used + 3 < size; c++) {
            if (*c == '|') text[used++] = ',', text[used++] = ' ';
            else text[used++] = *c;
        }
        text[used] = '\0';
        break;
    }
    case FIELD_VECTOR: snprintf(text, size, "[x, y, z]%s%s", allowed[0] ? ", each " : "", allowed); break;
    case FIELD_POINTS:
        snprintf(text, size, "list of [x, y, z]%s%s; %g to %g of them", allowed[0] ? ", each " : "", allowed, f->low,
                 f->high);
        break;
    case FIELD_NUMBERS:
        snprintf(text, size, "list of numbers%s%s; %g to %g of them", allowed[0] ? ", each " : "", allowed, f->low,
                 f->high);
        break;
    case FIELD_PAIRS: snprintf(text, size, "list of [time, number]; %g to %g of them", f->low, f->high); break;
    case FIELD_PART: snprintf(text, size, "keys: %s", f->section->title); break;
    case FIELD_LIST: snprintf(text, size, "list of: %s", f->section->title); break;
    case FIELD_NAMED: snprintf(text, size, "names, each with: %s", f->section->title); break;
    }
    return text;
}

static void describe(const scene_table *s, const scene_table **done, int *n) {
    char type[300];
    for (int k = 0; k < *n; k++)
        if (done[k] == s) return;
    if (*n >= 64) return;
    done[(*n)++] = s;
    printf("\n## %s\n\n%s\n\n| key | value | default | meaning |\n|---|---|---|---|\n", s->title, s->help);
    for (int k = 0; k < s->n; k++) {
        const scene_field *f = &s->field[k];
        printf("| `%s` | %s | %s | %s |\n", f->key, type_text(f, type, sizeof type),
               f->group         ? "one of these"
               : !f->fallback   ? "must be given"
               : f->fallback[0] ? f->fallback
                                : "-",
               f->help);
    }
    for (int k = 0; k < s->n; k++)
        if (s->field[k].section) describe(s->field[k].section, done, n);
}

void fields_describe(const scene_table *root) {
    const scene_table *done[64];
    int n = 0;
    describe(root, done, &n);
}
