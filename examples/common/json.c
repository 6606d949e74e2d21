#define _POSIX_C_SOURCE 200809L
#include "json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "machine.h"
#include "output.h"
#include "utf8.h"

enum { DEEPEST = 32 };

struct json {
    riddle_io_file *file;
    int depth;
    bool comma[DEEPEST]; /* something stands before, at this depth */
    char closer[DEEPEST];
};

/* Bytes of the character in UTF-8 that begins here; 0: none, as in a file name of another encoding. */
static int character_length(const unsigned char *c) {
    uint32_t code = 0;
    const int n = (int)utf8_get(c, 4, &code);
    return code >= 0xd800 && code < 0xe000 ? 0 : n; /* halves of UTF-16 */
}

static void write_text(json *j, const char *text) {
    int length;
    riddle_io_print(j->file, "\"");
    for (const unsigned char *c = (const unsigned char *)text; *c; c += length) {
        length = character_length(c);
        if (*c == '"' || *c == '\\') riddle_io_print(j->file, "\\%c", *c);
        else if (*c < 32 || *c == 127 || length == 0) riddle_io_print(j->file, "\\u%04x", *c);
        else riddle_io_write(j->file, c, (size_t)length);
        if (length == 0) length = 1;
    }
    riddle_io_print(j->file, "\"");
}

/* The comma, the line and the key before a value. */
static void before(json *j, const char *key) {
    if (j->comma[j->depth]) riddle_io_print(j->file, ",");
    j->comma[j->depth] = true;
    riddle_io_print(j->file, "\n%*s", 2 * (j->depth + 1), "");
    if (key) {
        write_text(j, key);
        riddle_io_print(j->file, ": ");
    }
}

static void write_number(json *j, double value) {
    if (value - value == 0.0) riddle_io_print(j->file, "%.17g", value);
    else riddle_io_print(j->file, "null");
}

static void open_level(json *j, const char *key, char opener, char closer) {
    if (!j || j->depth + 1 >= DEEPEST) return;
    before(j, key);
    riddle_io_print(j->file, "%c", opener);
    j->depth++;
    j->comma[j->depth] = false;
    j->closer[j->depth] = closer;
}

static void close_level(json *j) {
    if (!j || j->depth == 0) return;
    char closer = j->closer[j->depth--];
    riddle_io_print(j->file, "\n%*s%c", 2 * (j->depth + 1), "", closer);
}

json *json_open(const char *path) {
    if (!path) return NULL;
    json *j = calloc(1, sizeof *j);
    if (!j) {
        common_fail("%s: out of memory", path);
        return NULL;
    }
    j->file = riddle_io_open(NULL, path);
    if (!j->file) {
        free(j);
        return NULL;
    }
    riddle_io_print(j->file, "{");
    return j;
}

int json_close(json *j) {
    if (!j) return 0;
    while (j->depth > 0) close_level(j);
    riddle_io_print(j->file, "\n}\n");
    int status = (int)riddle_io_close(j->file);
    free(j);
    return status;
}

void json_discard(json *j) {
    if (!j) return;
    riddle_io_discard(j->file);
    free(j);
}

void json_number(json *j, const char *key, double value) {
    if (!j) return;
    before(j, key);
    write_number(j, value);
}

void json_integer(json *j, const char *key, long long value) {
    if (!j) return;
    before(j, key);
    riddle_io_print(j->file, "%lld", value);
}

void json_bool(json *j, const char *key, bool value) {
    if (!j) return;
    before(j, key);
    riddle_io_print(j->file, value ? "true" : "false");
}

void json_string(json *j, const char *key, const char *value) {
    if (!j) return;
    before(j, key);
    if (value) write_text(j, value);
    else riddle_io_print(j->file, "null");
}

void json_array(json *j, const char *key, const double *values, int n) {
    if (!j) return;
    before(j, key);
    riddle_io_print(j->file, "[");
    for (int i = 0; i < n; i++) {
        if (i) riddle_io_print(j->file, ", ");
        write_number(j, values[i]);
    }
    riddle_io_print(j->file, "]");
}

void json_integers(json *j, const char *key, const int *values, int n) {
    if (!j) return;
    before(j, key);
    riddle_io_print(j->file, "[");
    for (int i = 0; i < n; i++) riddle_io_print(j->file, "%s%d", i ? ", " : "", values[i]);
    riddle_io_print(j->file, "]");
}

void json_object_begin(json *j, const char *key) { open_level(j, key, '{', '}'); }

void json_object_end(json *j) { close_level(j); }

void json_array_begin(json *j, const char *key) { open_level(j, key, '[', ']'); }

void json_array_end(json *j) { close_level(j); }

void json_program(json *j, const program *self) {
    json_string(j, "program", self->name);
    json_integer(j, "threads", self->threads);
    if (j) {
        before(j, "seed");
        riddle_io_print(j->file, "%llu", (unsigned long long)self->seed);
    }
    json_bool(j, "quick", self->quick);
    json_number(j, "wall_s", machine_seconds() - self->started);
    json_number(j, "peak_memory_bytes", machine_peak_memory_bytes());
#ifdef __VERSION__
    json_string(j, "compiler", __VERSION__);
#endif
}
