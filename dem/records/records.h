/* A saved world as records: a name, the bytes of an entry, the number of entries, and the entries, little-endian. Knows
   bytes and memory, no physics. save/fields.h names what is saved, save/save.h and save/load.h use both. */
#pragma once
#include "../base/compiler.h"

/* A field that becomes a record. Its entries, of some numbers each, are `stride` bytes apart in memory. */
enum { DEM__NAME_BYTES = 24, DEM__HEAD_BYTES = DEM__NAME_BYTES + 16 };
typedef struct dem__saved_field {
    char name[DEM__NAME_BYTES]; /* at most 23 characters */
    void *data;                 /* of the first entry */
    size_t stride;
    int numbers, width; /* numbers of an entry; bytes of a number: 1, 4 or 8 */
} dem__saved_field;
#define DEM__DOUBLES(name, first, stride)                                                                              \
    { name, &(first), stride, (int)(sizeof(first) / (sizeof(double))), sizeof(double) }
#define DEM__INTEGER(name, first, stride)                                                                              \
    { name, &(first), stride, 1, (int)sizeof(first) }

/* Bytes that are written, only counted, or read. */
typedef struct dem__stream {
    unsigned char *to;         /* NULL: count only */
    const unsigned char *from; /* NULL: write */
    size_t at;
} dem__stream;

/* Returns the FNV-1a hash of n bytes. */
static inline uint64_t dem__checksum(const unsigned char *bytes, size_t n) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t k = 0; k < n; k++) hash = (hash ^ bytes[k]) * 0x100000001b3u;
    return hash;
}

/* Writes or reads a number of 1, 4 or 8 bytes in memory. */
static inline void dem__stream_number(dem__stream *s, void *number, int width) {
    uint64_t bits = 0;
    uint32_t half;
    unsigned char byte;
    if (s->from) {
        for (int k = 0; k < width; k++) bits |= (uint64_t)s->from[s->at + (size_t)k] << (8 * k);
        half = (uint32_t)bits, byte = (unsigned char)bits;
        memcpy(number, width == 8 ? (void *)&bits : width == 4 ? (void *)&half : (void *)&byte, (size_t)width);
    } else if (s->to) {
        memcpy(width == 8 ? (void *)&bits : width == 4 ? (void *)&half : (void *)&byte, number, (size_t)width);
        bits = width == 8 ? bits : width == 4 ? half : byte;
        for (int k = 0; k < width; k++) s->to[s->at + (size_t)k] = (unsigned char)(bits >> (8 * k) & 255u);
    }
    s->at += (size_t)width;
}
static inline void dem__stream_u64(dem__stream *s, uint64_t *v) { dem__stream_number(s, v, 8); }

/* Writes or reads entry k of a field. */
static inline void dem__stream_entry(dem__stream *s, const dem__saved_field *f, ptrdiff_t k) {
    unsigned char *number = (unsigned char *)f->data + (size_t)k * f->stride;
    for (int q = 0; q < f->numbers; q++) dem__stream_number(s, number + q * f->width, f->width);
}

/* Begins a record of n entries. */
static inline void dem__begin_record(dem__stream *s, const dem__saved_field *f, uint64_t n) {
    uint64_t bytes = (uint64_t)f->numbers * (uint64_t)f->width;
    if (s->to) memcpy(s->to + s->at, f->name, DEM__NAME_BYTES);
    s->at += DEM__NAME_BYTES;
    dem__stream_u64(s, &bytes), dem__stream_u64(s, &n);
}

/* A record in a file: where its entries begin, the bytes of an entry, the number of entries. */
typedef struct dem__record {
    size_t at;
    uint64_t bytes, count;
} dem__record;

/* Reads the head of the record at `at` of a file whose records end at `end`. Returns 0 if the record does not fit
   there. */
static inline int dem__read_head(const unsigned char *file, size_t end, size_t at, dem__record *r) {
    dem__stream s;
    if (end - at < DEM__HEAD_BYTES) return 0;
    s.to = NULL, s.from = file, s.at = at + DEM__NAME_BYTES;
    dem__stream_u64(&s, &r->bytes), dem__stream_u64(&s, &r->count);
    r->at = s.at;
    return r->bytes > 0 && r->count <= (end - r->at) / r->bytes;
}

/* Returns whether the bytes from `at` to `end` are complete records. */
static inline int dem__are_records(const unsigned char *file, size_t at, size_t end) {
    dem__record r;
    while (at < end) {
        if (!dem__read_head(file, end, at, &r)) return 0;
        at = r.at + (size_t)(r.bytes * r.count);
    }
    return at == end;
}

/* Finds the first of these records with a name. Returns 0 if there is none. */
static inline int dem__find_record(const unsigned char *file, size_t at, size_t end, const char *name, dem__record *r) {
    memset(r, 0, sizeof *r);
    for (; at < end; at = r->at + (size_t)(r->bytes * r->count)) {
        dem__read_head(file, end, at, r);
        if (memcmp(file + at, name, DEM__NAME_BYTES) == 0) return 1;
    }
    return 0;
}
