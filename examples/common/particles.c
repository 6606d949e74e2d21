#define _POSIX_C_SOURCE 200809L
#include "particles.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "csv.h"

static int refuse(particles *p, char *message, int message_size, const char *format, ...) COMMON_PRINTF(4, 5);
static int refuse(particles *p, char *message, int message_size, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, (size_t)message_size, format, arguments);
    va_end(arguments);
    particles_free(p);
    return -1;
}

void particles_free(particles *p) {
    free(p->memory);
    memset(p, 0, sizeof *p);
}

static bool make(particles *p, int n) {
    const size_t each = 10 * sizeof(double) + sizeof(int);
    memset(p, 0, sizeof *p);
    double *at = calloc((size_t)n + 1, each);
    if (!at) return false;
    p->memory = at;
    p->n = n;
    p->centre = at, p->velocity = at + 3 * (size_t)n, p->spin = at + 6 * (size_t)n, p->diameter = at + 9 * (size_t)n;
    p->group = (int *)(void *)(at + 10 * (size_t)n);
    return true;
}

/* Every sphere must have a place and a size, and nothing may be infinite. */
static int check(particles *p, const char *path, char *message, int message_size) {
    for (int i = 0; i < p->n; i++) {
        for (int k = 0; k < 9; k++) {
            if (!(fabs(p->centre[(size_t)(k / 3) * 3 * (size_t)p->n + 3 * (size_t)i + (size_t)(k % 3)]) <= 1e300))
                return refuse(p, message, message_size, "%s: sphere %d: a coordinate, velocity or spin is not a number",
                              path, i + 1);
        }
        if (!(p->diameter[i] > 0.0 && p->diameter[i] <= 1e300))
            return refuse(p, message, message_size, "%s: sphere %d: its diameter is not above 0", path, i + 1);
    }
    return 0;
}

/* ---- CSV ---- */

enum { COLUMNS = 12, DIAMETER = 9, RADIUS, GROUP };
static const char *const column_names[COLUMNS] = {"x",       "y",       "z",       "vx",       "vy",     "vz",
                                                  "omega_x", "omega_y", "omega_z", "diameter", "radius", "group"};

/* Finds the columns and the factors to SI units. */
static int find_columns(const csv_data *data, const char *path, int *column, double *factor, particles *p,
                        char *message, int message_size) {
    char said[900];
    for (int k = 0; k < COLUMNS; k++) {
        column[k] = csv_find(data, column_names[k], &factor[k], said, sizeof said);
        if (k == GROUP && column[k] < 0) column[k] = csv_find(data, "class", &factor[k], said, sizeof said);
        const char dimension = k == GROUP ? '#' : k / 3 == 1 ? 'v' : k / 3 == 2 ? 'w' : 'L';
        if (column[k] >= 0 && !csv_measures(data->names[column[k]], dimension))
            return refuse(p, message, message_size, "%s: the unit of column %.60s cannot be that of %s", path,
                          data->names[column[k]], column_names[k]);
        if (column[k] < 0 && (k < 3 || strncmp(said, "no column", 9) != 0))
            return refuse(p, message, message_size, "%s: %s", path, said);
    }
    if (column[DIAMETER] >= 0 || column[RADIUS] >= 0) return 0;
    csv_find(data, "diameter or radius", NULL, said, sizeof said);
    return refuse(p, message, message_size, "%s: %s", path, said);
}

static int parse_csv(const char *bytes, size_t size, const char *path, particles *p, char *message, int message_size) {
    csv_data data;
    int column[COLUMNS], status;
    double factor[COLUMNS];
    if (size > LONG_MAX) return refuse(p, message, message_size, "%s: too long", path);
    if (csv_parse(bytes, (long)size, path, &data, message, message_size) != 0) return -1;
    status = find_columns(&data, path, column, factor, p, message, message_size);
    if (status == 0 && !make(p, data.rows)) status = refuse(p, message, message_size, "%s: out of memory", path);
    for (int i = 0; i < data.rows && status == 0; i++) {
        double value[COLUMNS] = {0.0};
        for (int k = 0; k < COLUMNS && status == 0; k++) {
            if (column[k] < 0) continue;
            value[k] = factor[k] * data.values[(size_t)i * (size_t)data.columns + (size_t)column[k]];
            if (!(fabs(value[k]) <= 1e300) || (k == GROUP && (value[k] != floor(value[k]) || fabs(value[k]) > 2e9)))
                status =
                    refuse(p, message, message_size, "%s:%d: column %.60s: '%.60s' is not a %s", path, data.lines[i],
                           data.names[column[k]], data.cells[(size_t)i * (size_t)data.columns + (size_t)column[k]],
                           k == GROUP ? "whole number" : "number");
        }
        for (int k = 0; k < 9 && status == 0; k++)
            p->centre[(size_t)(k / 3) * 3 * (size_t)p->n + 3 * (size_t)i + (size_t)(k % 3)] = value[k];
        if (status != 0) break;
        if (column[DIAMETER] >= 0 && column[RADIUS] >= 0 && !(fabs(2.0 * value[RADIUS] / value[DIAMETER] - 1.0) < 1e-3))
            status =
                refuse(p, message, message_size, "%s:%d: the diameter is not twice the radius", path, data.lines[i]);
        if (status != 0) break;
        p->diameter[i] = column[DIAMETER] >= 0 ? value[DIAMETER] : 2.0 * value[RADIUS];
        p->group[i] = (int)value[GROUP];
    }
    csv_free(&data);
    return status == 0 ? check(p, path, message, message_size) : -1;
}

/* ---- .vtp ---- */

static const char *find(const char *text, const char *end, const char *what) {
    const size_t length = strlen(what);
    for (; text && (size_t)(end - text) >= length; text++) {
        if (memcmp(text, what, length) == 0) return text;
    }
    return NULL;
}

/* The value of an attribute within one tag, "" if it is not there. */
static void attribute(const char *tag, const char *end, const char *name, char *value, size_t size) {
    char key[64];
    snprintf(key, sizeof key, " %s=\"", name);
    const char *at = find(tag, end, key);
    size_t n = 0;
    for (at = at ? at + strlen(key) : end; at < end && *at != '"' && n + 1 < size; at++) value[n++] = *at;
    value[n] = '\0';
}

static uint64_t little(const unsigned char *bytes, int n) {
    uint64_t value = 0;
    for (int k = 0; k < n; k++) value |= (uint64_t)bytes[k] << (8 * k);
    return value;
}

/* Reads one array of the appended block into `to`, or an array of whole numbers into `integers`. */
static bool fetch(const char *raw, const char *end, const char *tag, const char *tag_end, int components, int n,
                  double *to, int *integers) {
    char type[16], offset_text[24], count_text[8];
    attribute(tag, tag_end, "type", type, sizeof type);
    attribute(tag, tag_end, "offset", offset_text, sizeof offset_text);
    attribute(tag, tag_end, "NumberOfComponents", count_text, sizeof count_text);
    const unsigned long long offset = strtoull(offset_text, NULL, 10), room = (unsigned long long)(end - raw);
    const unsigned long long bytes = 4ull * (unsigned long long)components * (unsigned long long)n;
    const bool is_float = strcmp(type, "Float32") == 0;
    if ((!is_float && strcmp(type, "Int32") != 0) || atoi(count_text) != components || room < 8 || offset > room - 8 ||
        bytes > room - 8 - offset)
        return false;
    const unsigned char *at = (const unsigned char *)raw + offset;
    if (little(at, 8) != bytes) return false;
    at += 8;
    for (int i = 0; i < n * components; i++, at += 4) {
        const uint32_t bits = (uint32_t)little(at, 4);
        float value;
        int32_t whole;
        memcpy(&value, &bits, sizeof value);
        memcpy(&whole, &bits, sizeof whole);
        if (!integers) to[i] = is_float ? (double)value : whole;
        else if (!is_float) integers[i] = whole;
        else if (value == floorf(value) && fabsf(value) <= 2e9f) integers[i] = (int)value;
        else return false;
    }
    return true;
}

/* The arrays that are read. One of groups is enough. */
enum { VTP_DIAMETER, VTP_RADIUS, VTP_VELOCITY, VTP_SPIN, VTP_GROUP, VTP_CLASS, VTP_SPECIES, VTP_ARRAYS };
static const struct {
    const char *name;
    char dimension;
    int components;
} vtp_arrays[VTP_ARRAYS] = {{"diameter", 'L', 1}, {"radius", 'L', 1}, {"velocity", 'v', 3}, {"spin", 'w', 3},
                            {"group", '#', 1},    {"class", '#', 1},  {"species", '#', 1}};

typedef struct vtp_file {
    const char *raw, *end, *path;
    bool seen[VTP_ARRAYS];
} vtp_file;

/* Reads diameters or radii. If they came before, they must agree. */
static bool fetch_sizes(const vtp_file *file, const char *tag, const char *tag_end, double factor, particles *p) {
    double *size = malloc(((size_t)p->n + 1) * sizeof *size);
    bool good = size && fetch(file->raw, file->end, tag, tag_end, 1, p->n, size, NULL);
    for (int i = 0; i < p->n && good; i++) {
        if (file->seen[VTP_DIAMETER] || file->seen[VTP_RADIUS])
            good = fabs(factor * size[i] / p->diameter[i] - 1.0) < 1e-3;
        else p->diameter[i] = factor * size[i];
    }
    free(size);
    return good;
}

/* Reads an array of point data if its name is one of the table. */
static int take_array(vtp_file *file, const char *tag, const char *points, particles *p, char *message,
                      int message_size) {
    const char *tag_end = find(tag, points, ">");
    char name[64];
    double factor = 1.0;
    int k = 0, is = 0;
    attribute(tag, tag_end ? tag_end : points, "Name", name, sizeof name);
    while (k < VTP_ARRAYS && (is = csv_is(name, vtp_arrays[k].name, &factor)) == 0) k++;
    if (k == VTP_ARRAYS || !tag_end || (k > VTP_GROUP && file->seen[VTP_GROUP])) return 0;
    if (is < 0 || !csv_measures(name, vtp_arrays[k].dimension))
        return refuse(p, message, message_size, "%s: the unit of array %s cannot be that of %s", file->path, name,
                      vtp_arrays[k].name);
    if (file->seen[k])
        return refuse(p, message, message_size, "%s: two arrays are named %s", file->path, vtp_arrays[k].name);
    double *to = k == VTP_VELOCITY ? p->velocity : p->spin;
    const bool good = k <= VTP_RADIUS ? fetch_sizes(file, tag, tag_end, k == VTP_RADIUS ? 2.0 * factor : factor, p)
                                      : fetch(file->raw, file->end, tag, tag_end, vtp_arrays[k].components, p->n, to,
                                              k >= VTP_GROUP ? p->group : NULL);
    if (!good)
        return refuse(p, message, message_size, "%s: the array %s is damaged or of another type", file->path, name);
    for (int i = 0; i < 3 * p->n && (k == VTP_VELOCITY || k == VTP_SPIN); i++) to[i] *= factor;
    file->seen[k] = true;
    return 0;
}

static int parse_vtp(const char *bytes, size_t size, const char *path, particles *p, char *message, int message_size) {
    const char *end = bytes + size, *raw = find(bytes, end, "<AppendedData encoding=\"raw\">"),
               *piece = find(bytes, raw ? raw : bytes, "<Piece ");
    const char *points = piece ? find(piece, raw, "<Points>") : NULL;
    char text[64];
    if (!find(bytes, raw ? raw : bytes, "header_type=\"UInt64\"") || !points || !(raw = find(raw, end, "_")))
        return refuse(p, message, message_size, "%s: not a .vtp file of raw appended data with 64-bit headers", path);
    raw++;
    attribute(piece, points, "NumberOfPoints", text, sizeof text);
    const long n = strtol(text, NULL, 10);
    if (n < 0 || n > INT_MAX / 16 || (size_t)n > size / 12)
        return refuse(p, message, message_size, "%s: NumberOfPoints is wrong", path);
    if (!make(p, (int)n)) return refuse(p, message, message_size, "%s: out of memory", path);
    if (find(points, raw, "<Piece ")) return refuse(p, message, message_size, "%s: more than one piece", path);
    vtp_file file = {raw, end, path, {false}};
    const char *tag = piece, *tag_end;
    while ((tag = find(tag + 1, points, "<DataArray ")) != NULL) {
        if (take_array(&file, tag, points, p, message, message_size) != 0) return -1;
    }
    tag = find(points, raw, "<DataArray ");
    tag_end = tag ? find(tag, raw, ">") : NULL;
    if (!tag_end) return refuse(p, message, message_size, "%s: no points", path);
    if (!fetch(raw, end, tag, tag_end, 3, p->n, p->centre, NULL))
        return refuse(p, message, message_size, "%s: the array of points is damaged or of another type", path);
    if (!file.seen[VTP_DIAMETER] && !file.seen[VTP_RADIUS])
        return refuse(p, message, message_size, "%s: no diameter or radius", path);
    return check(p, path, message, message_size);
}

/* ---- both ---- */

int particles_parse(const char *bytes, size_t size, const char *path, particles *p, char *message, int message_size) {
    const size_t length = strlen(path);
    memset(p, 0, sizeof *p);
    if (length > 4 && strcmp(path + length - 4, ".vtp") == 0)
        return parse_vtp(bytes, size, path, p, message, message_size);
    return parse_csv(bytes, size, path, p, message, message_size);
}

int particles_read(const char *path, particles *p, char *message, int message_size) {
    memset(p, 0, sizeof *p);
    FILE *file = fopen(path, "rb");
    char *bytes = NULL;
    size_t size = 0, capacity = 0, got = 1;
    if (!file) return refuse(p, message, message_size, "%s: cannot be read", path);
    while (got > 0) {
        if (size == capacity) {
            capacity = 2 * capacity + 65536;
            char *larger = realloc(bytes, capacity);
            if (!larger) break;
            bytes = larger;
        }
        got = fread(bytes + size, 1, capacity - size, file);
        size += got;
    }
    const bool failed = ferror(file) != 0 || got > 0;
    fclose(file);
    const int status = failed ? refuse(p, message, message_size, "%s: cannot be read whole", path)
                              : particles_parse(bytes, size, path, p, message, message_size);
    free(bytes);
    return status;
}
