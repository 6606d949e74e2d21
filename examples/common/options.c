#define _POSIX_C_SOURCE 200809L
#include "options.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "machine.h"
#include "output.h"
#include "progress.h"

#ifndef RIDDLE_VERSION /* meson.build sets it */
#define RIDDLE_VERSION "of a build without meson"
#endif

enum { COMMON_OPTIONS = 7, LONGEST_NAME = 60, LONGEST_OUT = 700 };

static option make(option_kind kind, const char *name, const char *metavar, void *value, const char *help) {
    option o = {name, metavar, kind, value, -HUGE_VAL, HUGE_VAL, false, NULL, help, false};
    return o;
}

option option_flag(const char *name, bool *value, const char *help) {
    return make(OPTION_FLAG, name, NULL, value, help);
}

option option_int(const char *name, const char *metavar, int *value, int low, int high, const char *help) {
    option o = make(OPTION_INT, name, metavar, value, help);
    o.low = low;
    o.high = high;
    return o;
}

option option_seed(const char *name, const char *metavar, uint64_t *value, const char *help) {
    return make(OPTION_SEED, name, metavar, value, help);
}

option option_double(const char *name, const char *metavar, double *value, double low, double high, const char *help) {
    option o = make(OPTION_DOUBLE, name, metavar, value, help);
    o.low = low;
    o.high = high;
    return o;
}

option option_positive(const char *name, const char *metavar, double *value, double high, const char *help) {
    option o = option_double(name, metavar, value, 0.0, high, help);
    o.above = true;
    return o;
}

option option_string(const char *name, const char *metavar, const char **value, const char *help) {
    return make(OPTION_STRING, name, metavar, value, help);
}

option option_choice(const char *name, int *value, const char *choices, const char *help) {
    option o = make(OPTION_CHOICE, name, choices, value, help);
    o.choices = choices;
    return o;
}

option option_size(const char *name, int size[2], const char *help) {
    option o = make(OPTION_SIZE, name, "WxH", size, help);
    o.low = 64.0, o.high = 4096.0; /* as in picture_new */
    return o;
}

/* "a number above 0 and at most 20" */
static void allowed(const option *o, char *text, size_t size) {
    const char *noun = o->kind == OPTION_DOUBLE ? "a number" : "a whole number";
    switch (o->kind) {
    case OPTION_FLAG: snprintf(text, size, "no value"); return;
    case OPTION_STRING: snprintf(text, size, "a text that is not empty"); return;
    case OPTION_CHOICE: snprintf(text, size, "one of %s", o->choices); return;
    case OPTION_SIZE:
        snprintf(text, size, "width x height, such as 1920x1280, each from %.0f to %.0f", o->low, o->high);
        return;
    case OPTION_SEED: snprintf(text, size, "a whole number from 0 to %llu", (unsigned long long)UINT64_MAX); return;
    case OPTION_INT:
    case OPTION_DOUBLE: break;
    }
    bool has_low = o->low > -HUGE_VAL, has_high = o->high < HUGE_VAL;
    const char *from = o->above ? "above" : has_high ? "from" : "of at least";
    if (has_low && has_high)
        snprintf(text, size, "%s %s %.10g %s %.10g", noun, from, o->low, o->above ? "and at most" : "to", o->high);
    else if (has_low) snprintf(text, size, "%s %s %.10g", noun, from, o->low);
    else if (has_high) snprintf(text, size, "%s of at most %.10g", noun, o->high);
    else snprintf(text, size, "%s", noun);
}

static int choice_index(const char *choices, const char *text) {
    size_t length = strlen(text);
    int index = 0;
    for (const char *at = choices;; index++) {
        const char *end = strchr(at, '|');
        size_t here = end ? (size_t)(end - at) : strlen(at);
        if (here == length && memcmp(at, text, length) == 0) return index;
        if (!end) return -1;
        at = end + 1;
    }
}

/* Digits only as the first character (after a sign): strtod alone would take " 1", "nan", "inf" and "0x1p3". */
static bool looks_like_number(const char *text, bool fraction) {
    const char *allowed_characters = fraction ? "0123456789+-.eE" : "0123456789+-";
    return *text && text[strspn(text, allowed_characters)] == '\0';
}

/* "1920x1280" */
static bool set_size(const option *o, const char *text) {
    char *end = NULL;
    int size[2];
    for (int k = 0; k < 2; k++, text = end + 1) {
        const long v = *text >= '0' && *text <= '9' ? strtol(text, &end, 10) : -1;
        if (!((double)v >= o->low && (double)v <= o->high) || *end != (k ? '\0' : 'x')) return false;
        size[k] = (int)v;
    }
    memcpy(o->value, size, sizeof size);
    return true;
}

static bool set_value(option *o, const char *text) {
    char *end = NULL;
    errno = 0;
    switch (o->kind) {
    case OPTION_FLAG: return false;
    case OPTION_INT: {
        if (!looks_like_number(text, false)) return false;
        long value = strtol(text, &end, 10);
        if (*end || errno || (double)value < o->low || (double)value > o->high || value < INT_MIN || value > INT_MAX)
            return false;
        *(int *)o->value = (int)value;
        return true;
    }
    case OPTION_SEED: {
        if (!looks_like_number(text, false) || strchr(text, '-')) return false;
        unsigned long long value = strtoull(text, &end, 10);
        if (*end || errno) return false;
        *(uint64_t *)o->value = value;
        return true;
    }
    case OPTION_DOUBLE: {
        if (!looks_like_number(text, true)) return false;
        double value = strtod(text, &end);
        bool overflow = !(fabs(value) < HUGE_VAL);
        if (*end || overflow || !(value >= o->low && value <= o->high) || (o->above && value == o->low)) return false;
        *(double *)o->value = value;
        return true;
    }
    case OPTION_STRING:
        if (!*text) return false;
        *(const char **)o->value = text;
        return true;
    case OPTION_SIZE: return set_size(o, text);
    case OPTION_CHOICE: {
        int index = choice_index(o->choices, text);
        if (index < 0) return false;
        *(int *)o->value = index;
        return true;
    }
    }
    return false;
}

/* Levenshtein distance; names are short. */
static int distance(const char *a, size_t length, const char *b) {
    int row[LONGEST_NAME + 1];
    size_t width = strlen(b);
    if (length > LONGEST_NAME || width > LONGEST_NAME) return INT_MAX;
    for (size_t j = 0; j <= width; j++) row[j] = (int)j;
    for (size_t i = 1; i <= length; i++) {
        int diagonal = row[0];
        row[0] = (int)i;
        for (size_t j = 1; j <= width; j++) {
            int best = diagonal + (a[i - 1] != b[j - 1]);
            diagonal = row[j];
            if (row[j] + 1 < best) best = row[j] + 1;
            if (row[j - 1] + 1 < best) best = row[j - 1] + 1;
            row[j] = best;
        }
    }
    return row[width];
}

static const option *nearest(const option *const *all, int n, const char *name, size_t length) {
    const option *best = NULL;
    int best_distance = 1 + (int)length / 2;
    for (int i = 0; i < n; i++) {
        int d = distance(name, length, all[i]->name);
        if (length > 2 && strncmp(all[i]->name, name, length) == 0) d = 1;
        if (d < best_distance) {
            best = all[i];
            best_distance = d;
        }
    }
    return best;
}

static const char *said_out, *said_seed;

void program_say_defaults(const char *out, const char *seed) { said_out = out, said_seed = seed; }

static void print_default(const option *o) {
    const char *said = strcmp(o->name, "out") == 0 ? said_out : strcmp(o->name, "seed") == 0 ? said_seed : NULL;
    if (said) {
        printf(" (default %s)", said);
        return;
    }
    switch (o->kind) {
    case OPTION_FLAG: break;
    case OPTION_INT: printf(" (default %d)", *(int *)o->value); break;
    case OPTION_SEED: printf(" (default %llu)", (unsigned long long)*(uint64_t *)o->value); break;
    case OPTION_SIZE: printf(" (default %dx%d)", ((int *)o->value)[0], ((int *)o->value)[1]); break;
    case OPTION_DOUBLE: printf(" (default %.10g)", *(double *)o->value); break;
    case OPTION_STRING:
        if (*(const char **)o->value) printf(" (default %s)", *(const char **)o->value);
        break;
    case OPTION_CHOICE: {
        const char *at = o->choices;
        for (int i = *(int *)o->value; i > 0 && strchr(at, '|'); i--) at = strchr(at, '|') + 1;
        printf(" (default %.*s)", (int)strcspn(at, "|"), at);
        break;
    }
    }
}

static void print_help(const char *name, const char *about, const option *const *all, int n) {
    printf("%s: %s\n\n", name, about);
    if (!strstr(about, "usage: ")) printf("usage: %s [options]\n", name);
    int width = 0;
    for (int i = 0; i < n; i++) {
        int here = (int)(strlen(all[i]->name) + (all[i]->metavar ? strlen(all[i]->metavar) + 1 : 0));
        if (here > width && here <= 26) width = here;
    }
    for (int i = 0; i < n; i++) {
        const option *o = all[i];
        char left[200], range[200];
        int used = snprintf(left, sizeof left, "%s%s%s", o->name, o->metavar ? " " : "", o->metavar ? o->metavar : "");
        if (used > width) printf("  --%s\n    %*s  %s", left, width, "", o->help);
        else printf("  --%-*s  %s", width, left, o->help);
        if ((o->kind == OPTION_INT || o->kind == OPTION_DOUBLE) && (o->low > -HUGE_VAL || o->high < HUGE_VAL)) {
            allowed(o, range, sizeof range);
            printf(", %s", range + (o->kind == OPTION_INT ? strlen("a whole number ") : strlen("a number ")));
        }
        print_default(o);
        putchar('\n');
    }
}

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
static int
refuse(char *message, int size, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, (size_t)size, format, arguments);
    va_end(arguments);
    for (char *c = message; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127) *c = '?'; /* the message stays one line, whatever the value holds */
    return 2;
}

static int parse(const char *program_name, option **all, int n, int argc, char **argv, char *message, int size) {
    char range[200];
    for (int i = 1; i < argc; i++) {
        const char *argument = argv[i];
        if (strcmp(argument, "-h") == 0) return 1;
        if (strncmp(argument, "--", 2) != 0 || !argument[2])
            return refuse(message, size, "%s: '%s' is not an option; --help lists them", program_name, argument);
        const char *name = argument + 2, *equals = strchr(name, '=');
        size_t length = equals ? (size_t)(equals - name) : strlen(name);
        if (length == 4 && memcmp(name, "help", 4) == 0 && !equals) return 1;
        option *found = NULL;
        for (int k = 0; k < n; k++)
            if (strlen(all[k]->name) == length && memcmp(all[k]->name, name, length) == 0) found = all[k];
        if (!found) {
            const option *guess = nearest((const option *const *)all, n, name, length);
            return refuse(message, size, "%s: unknown option --%.*s%s%s%s; --help lists all", program_name, (int)length,
                          name, guess ? ", did you mean --" : "", guess ? guess->name : "", guess ? "?" : "");
        }
        allowed(found, range, sizeof range);
        if (found->kind == OPTION_FLAG) {
            if (equals)
                return refuse(message, size, "%s: --%s %s: takes no value", program_name, found->name, equals + 1);
            *(bool *)found->value = true;
            found->given = true;
            continue;
        }
        const char *text = equals ? equals + 1 : i + 1 < argc && strncmp(argv[i + 1], "--", 2) != 0 ? argv[++i] : NULL;
        if (!text) return refuse(message, size, "%s: --%s has no value; allowed: %s", program_name, found->name, range);
        if (!set_value(found, text))
            return refuse(message, size, "%s: --%s %s: allowed: %s", program_name, found->name, text, range);
        found->given = true;
    }
    return 0;
}

/* The options of the program, then the common ones; fields of *self hold the defaults. */
static int collect(program *self, option common[COMMON_OPTIONS], option *options, int n, option **all) {
    int k = 0, total = 0;
    common[k++] = option_string("out", "DIR", &self->out, "folder for everything that is written");
    common[k++] = option_int("threads", "N", &self->threads, 1, 4096, "threads");
    common[k++] = option_seed("seed", "N", &self->seed, "seed of the random numbers");
    common[k++] = option_flag("quick", &self->quick, "a smaller run of under 10 s");
    common[k++] = option_flag("quiet", &self->quiet, "print nothing but errors");
    common[k++] = option_string("json", "FILE", &self->json, "write one JSON object with the results");
    common[k++] = option_flag("version", &self->version, "Riddle's version; the other options are checked before");
    for (int i = 0; i < n; i++) all[total++] = &options[i];
    for (int i = 0; i < k; i++) all[total++] = &common[i];
    return total;
}

int options_parse(program *self, option *options, int n, int argc, char **argv, char *message, int message_size) {
    option common[COMMON_OPTIONS], **all = malloc((size_t)(n + COMMON_OPTIONS) * sizeof *all);
    if (!all) return refuse(message, message_size, "%s: out of memory", self->name);
    int total = collect(self, common, options, n, all);
    int status = parse(self->name, all, total, argc, argv, message, message_size);
    free(all);
    return status;
}

/* Ends the program after what it was only asked to say. */
static void leave(void) { exit(common_exit_status()); }

program program_start(const char *name, const char *about, option *options, int n, int argc, char **argv) {
    static char default_out[200];
    char message[600] = "";
    program self = {name, default_out, NULL, machine_cores(), 1, false, false, false, machine_seconds(), options, n};
    snprintf(default_out, sizeof default_out, "out/%s", name);
    program defaults = self;
    int status = 0;
    common_open_standard_streams();
    /* --help first: it shows the defaults, not what else stood on the line */
    for (int i = 1; i < argc && status == 0; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) status = 1;
    }
    if (status == 1) {
        option common[COMMON_OPTIONS], **all = malloc((size_t)(n + COMMON_OPTIONS + 1) * sizeof *all);
        if (!all) exit(1);
        int total = collect(&defaults, common, options, n, all);
        option help = option_flag("help", &defaults.quiet, "this text");
        all[total++] = &help;
        print_help(name, about, (const option *const *)all, total);
        free(all);
        leave();
    }
    status = options_parse(&self, options, n, argc, argv, message, (int)sizeof message);
    if (status == 0 && self.version) {
        printf("%s, Riddle %s\n", name, RIDDLE_VERSION);
        leave();
    }
    if (status == 0 && strlen(self.out) > LONGEST_OUT)
        status = refuse(message, (int)sizeof message, "%s: --out %.60s...: allowed: a path of at most %d bytes", name,
                        self.out, LONGEST_OUT);
    if (status == 0 && riddle_io_make_folder(self.out, message, sizeof message) != 0) {
        char why[600];
        snprintf(why, sizeof why, "%s", message);
        status = refuse(message, (int)sizeof message, "%s: --out %s: %s; allowed: a folder that can be written to",
                        name, self.out, why);
    }
    if (status == 0 && self.json && riddle_io_can_write(self.json, message, sizeof message) != 0) {
        char why[600];
        snprintf(why, sizeof why, "%s", message);
        status = refuse(message, (int)sizeof message, "%s: --json %s: %s; allowed: a file that can be written", name,
                        self.json, why);
    }
    if (status != 0) {
        fprintf(stderr, "%s\n", message);
        exit(2);
    }
    common_set_quiet(self.quiet);
    common_set_name(name);
    common_catch_interrupt();
    return self;
}

bool is_given(const program *self, const char *name) {
    for (int k = 0; k < self->option_count; k++)
        if (strcmp(self->options[k].name, name) == 0) return self->options[k].given;
    fprintf(stderr, "%s: is_given(\"%s\"): there is no such option\n", self->name, name);
    abort();
}

void program_refuse(const program *self, const char *option_name, const char *value, const char *allowed_text) {
    fprintf(stderr, "%s: --%s%s%s: allowed: %s\n", self->name, option_name, value ? " " : "", value ? value : "",
            allowed_text);
    exit(2);
}

void program_need_memory(const program *self, const char *option_name, double bytes) {
    const double there = machine_free_memory_bytes();
    if (bytes <= there) return;
    char allowed_text[160];
    snprintf(allowed_text, sizeof allowed_text, "what fits into %.3g GB of free memory; this takes about %.3g GB",
             1e-9 * there, 1e-9 * bytes);
    program_refuse(self, option_name, NULL, allowed_text);
}

void program_need_spheres(const program *self, const char *option_name, double spheres) {
    static const double each = 1400.0; /* [B] with lists and history: scripts/verify long_and_large */
    program_need_memory(self, option_name, each * spheres);
}

uint64_t program_seed_of(uint64_t seed, uint64_t index) {
    uint64_t z = seed;
    for (int k = 0; k < 2; k++) { /* splitmix64's mixer, over the seed and then the index */
        z += UINT64_C(0x9e3779b97f4a7c15) + (k ? index : 0);
        z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
        z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
        z ^= z >> 31;
    }
    return z;
}
