/* Groups of fields that have the same number of entries: writing and reading them, and hashes of numbers. */
#pragma once
#include "../base/engine.h"
#include "records.h"

enum { DEM__FIELDS_MAX = 64 + DEM_STATE_MAX };

/* Fields with the same number of entries. */
typedef struct dem__group {
    int fields, needed; /* the first `needed` of them are required */
    dem__saved_field field[DEM__FIELDS_MAX];
} dem__group;

static inline void dem__set_fields(dem__group *g, const dem__saved_field *field, size_t bytes, int needed) {
    memcpy(g->field, field, bytes);
    g->fields = (int)(bytes / sizeof *field), g->needed = needed;
}
/* Adds fields that are not required. */
static inline void dem__add_optional(dem__group *g, const dem__saved_field *field, size_t bytes) {
    memcpy(&g->field[g->fields], field, bytes);
    g->fields += (int)(bytes / sizeof *field);
}

/* Adds arrays of doubles, numbered: contact.wrench0, contact.wrench1 .. */
static inline void dem__add_fields(dem__group *g, const char *name, double *const *array, int n) {
    for (int k = 0; k < n; k++) {
        dem__saved_field *f = &g->field[g->fields++];
        const size_t length = strlen(name);
        memset(f, 0, sizeof *f);
        memcpy(f->name, name, length);
        if (k > 9) f->name[length] = (char)('0' + k / 10);
        f->name[length + (k > 9)] = (char)('0' + k % 10);
        f->data = array[k], f->stride = sizeof(double), f->numbers = 1, f->width = sizeof(double);
    }
}

/* Writes entry `at` of a group's field. is_body: the field is an index of a particle, which becomes its index among
   those present. */
static inline void dem__write_entry(dem__stream *s, const dem_world *w, const dem__saved_field *f, ptrdiff_t at,
                                    int is_body) {
    if (!is_body) {
        dem__stream_entry(s, f, at);
        return;
    }
    int32_t body = *(const int32_t *)(const void *)((const unsigned char *)f->data + (size_t)at * f->stride);
    if (body >= 0) body = w->engine->bodies.number[body];
    dem__stream_number(s, &body, sizeof body);
}

/* Writes a group of n consecutive entries. The first `bodies` fields are indices of particles. */
static inline void dem__write_group(dem__stream *s, const dem_world *w, const dem__group *g, ptrdiff_t n, int bodies) {
    for (int q = 0; q < g->fields && n > 0; q++) {
        dem__begin_record(s, &g->field[q], (uint64_t)n);
        for (ptrdiff_t k = 0; k < n; k++) dem__write_entry(s, w, &g->field[q], k, q < bodies);
    }
}

/* A file being read: its bytes, and where its records begin and end. */
typedef struct dem__file {
    const unsigned char *bytes;
    size_t first, end;
} dem__file;

/* Returns whether the bytes are a complete and unchanged saved world of this format. */
static inline int dem__open_file(dem__file *file, const void *buffer, size_t size) {
    uint64_t magic, version, check;
    dem__stream s = {NULL, (const unsigned char *)buffer, 0};
    if (size < 24) return 0;
    dem__stream_u64(&s, &magic), dem__stream_u64(&s, &version);
    file->bytes = s.from, file->first = s.at, file->end = s.at = size - 8;
    dem__stream_u64(&s, &check);
    return magic == DEM__MAGIC && version == DEM__FORMAT && check == dem__checksum(file->bytes, file->end) &&
           dem__are_records(file->bytes, file->first, file->end);
}

/* Returns the number of entries of a group in a file, from its first field, which is required. */
static inline ptrdiff_t dem__entries_of(const dem__file *file, const char *first) {
    char name[DEM__NAME_BYTES];
    dem__record r;
    memset(name, 0, sizeof name);
    memcpy(name, first, strlen(first));
    return dem__find_record(file->bytes, file->first, file->end, name, &r) && r.count < INT32_MAX / 4
               ? (ptrdiff_t)r.count
               : 0;
}

/* Finds a field of n entries. Returns 1 if it is there, 0 if it is missing and not required, -1 if it is required and
   missing, or of another kind. */
static inline int dem__find_field(const dem__file *file, const dem__group *g, int field, ptrdiff_t n, dem__stream *s) {
    const dem__saved_field *f = &g->field[field];
    dem__record r;
    if (!dem__find_record(file->bytes, file->first, file->end, f->name, &r)) return field < g->needed ? -1 : 0;
    s->to = NULL, s->from = file->bytes, s->at = r.at;
    return r.bytes == (uint64_t)f->numbers * (uint64_t)f->width && r.count == (uint64_t)n ? 1 : -1;
}

/* Reads entries first .. end-1 of a group of n into consecutive ones from `to` on. Returns 0 if the file is not
   valid. */
static inline int dem__read_some(const dem__file *file, const dem__group *g, ptrdiff_t n, ptrdiff_t first,
                                 ptrdiff_t end, ptrdiff_t to) {
    for (int q = 0; q < g->fields && n > 0; q++) {
        const dem__saved_field *f = &g->field[q];
        dem__stream s;
        const int found = dem__find_field(file, g, q, n, &s);
        if (found < 0) return 0;
        s.at += (size_t)first * (size_t)(f->numbers * f->width);
        for (ptrdiff_t k = first; k < end && found; k++) dem__stream_entry(&s, f, to + k - first);
    }
    return 1;
}

/* Reads all n entries of a group. */
static inline int dem__read_group(const dem__file *file, const dem__group *g, ptrdiff_t n) {
    return dem__read_some(file, g, n, 0, n, 0);
}

static inline int dem__is_flag(int v) { return v == 0 || v == 1; }

/* Returns whether i is a particle, and j another particle or a wall. */
static inline int dem__are_bodies(const dem_world *w, int32_t i, int32_t j) {
    return i >= 0 && i < w->count && j < w->count && j >= -w->walls && i != j;
}

/* Adds a number of 8 bytes to an FNV-1a hash. */
DEM_INLINE void dem__hash_u64(uint64_t *hash, uint64_t v) {
    for (int k = 0; k < 8; k++) *hash = (*hash ^ (v >> (8 * k) & 255u)) * 0x100000001b3u;
}
static inline void dem__hash_i64(uint64_t *hash, int64_t v) { dem__hash_u64(hash, (uint64_t)v); }
static inline void dem__hash_f64(uint64_t *hash, const double *v, int n) {
    for (int k = 0; k < n; k++) {
        uint64_t bits;
        memcpy(&bits, &v[k], sizeof bits);
        dem__hash_u64(hash, bits);
    }
}
static inline void dem__hash_vec(uint64_t *hash, dem_vec v) {
    dem__hash_f64(hash, &v.x, 1), dem__hash_f64(hash, &v.y, 1), dem__hash_f64(hash, &v.z, 1);
}

static inline void dem__hash_quaternion(uint64_t *hash, dem_quaternion q) {
    dem__hash_f64(hash, &q.w, 1), dem__hash_f64(hash, &q.x, 1), dem__hash_f64(hash, &q.y, 1),
        dem__hash_f64(hash, &q.z, 1);
}

/* Adds the bodies of a contact or a link, as indices among those present, and its element. */
static inline void dem__hash_bodies(uint64_t *hash, const dem_world *w, int32_t i, int32_t j, int32_t element) {
    const int32_t *number = w->engine->bodies.number;
    dem__hash_i64(hash, number[i]), dem__hash_i64(hash, j >= 0 ? number[j] : j), dem__hash_i64(hash, element);
}
