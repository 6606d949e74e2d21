/* voxel_file.h: images of cubes from files, as grey values: raw bytes, TIFF of many pages (8 or 16 bits, not
   compressed), ParaView .vti (one array, text, base64 or raw, not compressed). */
#ifndef RIDDLE_VOXEL_FILE_H
#define RIDDLE_VOXEL_FILE_H

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VOXEL_U8, VOXEL_U16, VOXEL_F32 };

typedef struct voxel_image {
    int n[3];     /* x fastest */
    float *value; /* [n[2]][n[1]][n[0]]; free() */
    double edge;  /* of a cube in the file's own unit, 0: the file does not say */
} voxel_image;

static inline int voxel_fail(char *message, size_t size, const char *format, ...) {
    va_list list;
    va_start(list, format);
    vsnprintf(message, size, format, list);
    va_end(list);
    for (char *at = message; *at; at++)
        if ((unsigned char)*at < ' ') *at = '?'; /* names from a file: still one line */
    return -1;
}

static inline uint64_t voxel_number(const unsigned char *at, int bytes, int big) {
    uint64_t value = 0;
    for (int k = 0; k < bytes; k++) value |= (uint64_t)at[big ? bytes - 1 - k : k] << (8 * k);
    return value;
}

/* One value of a type by its letter (u, i, f) and bytes. */
static inline double voxel_value(const unsigned char *at, char letter, int bytes, int big) {
    const uint64_t bits = voxel_number(at, bytes, big);
    if (letter == 'u') return (double)bits;
    if (letter == 'i') return bits >> (8 * bytes - 1) & 1 ? (double)bits - ldexp(1.0, 8 * bytes) : (double)bits;
    if (bytes == 4) {
        const uint32_t half = (uint32_t)bits;
        float value;
        memcpy(&value, &half, 4);
        return (double)value;
    }
    double value;
    memcpy(&value, &bits, 8);
    return value;
}

/* Makes room for the values; at most 1e9 cubes. */
static inline int voxel_make(voxel_image *m, const double n[3], char *message, size_t size) {
    for (int k = 0; k < 3; k++)
        if (!(n[k] >= 1.0 && n[k] <= 1e6)) return voxel_fail(message, size, "%g x %g x %g cubes", n[0], n[1], n[2]);
    if (n[0] * n[1] * n[2] > 1e9) return voxel_fail(message, size, "%g cubes; at most 1e9", n[0] * n[1] * n[2]);
    for (int k = 0; k < 3; k++) m->n[k] = (int)n[k];
    m->value = malloc((size_t)(n[0] * n[1] * n[2]) * sizeof *m->value);
    return m->value ? 0 : voxel_fail(message, size, "out of memory");
}

static inline size_t voxel_count(const voxel_image *m) { return (size_t)m->n[0] * (size_t)m->n[1] * (size_t)m->n[2]; }

/* ---- raw ---- */

static inline int voxel_raw(const unsigned char *b, size_t bytes, const double n[3], int type, size_t skip,
                            voxel_image *m, char *message, size_t size) {
    const int wide = type == VOXEL_U8 ? 1 : type == VOXEL_U16 ? 2 : 4;
    const double wanted = n[0] * n[1] * n[2] * wide + (double)skip;
    if (wanted != (double)bytes)
        return voxel_fail(message, size, "has %.0f bytes; %.0f x %.0f x %.0f values of %d bytes%s are %.0f",
                          (double)bytes, n[0], n[1], n[2], wide, skip ? " after those passed over" : "", wanted);
    if (voxel_make(m, n, message, size) != 0) return -1;
    const size_t count = voxel_count(m);
    for (size_t i = 0; i < count; i++)
        m->value[i] = (float)voxel_value(b + skip + i * (size_t)wide, type == VOXEL_F32 ? 'f' : 'u', wide, 0);
    return 0;
}

/* ---- TIFF 6.0 ---- */

typedef struct voxel_page {
    double width, height, bits, compression, inverted, samples, rows, strips;
    size_t offsets, counts;  /* where the lists of strips lie */
    int of_offset, of_count; /* bytes of their numbers */
} voxel_page;

/* Reads a directory of tags at `at`. Returns where the next one lies, 0: none; SIZE_MAX: the file ends before. */
static inline size_t voxel_read_page(const unsigned char *b, size_t bytes, int big, size_t at, voxel_page *page) {
    memset(page, 0, sizeof *page);
    page->compression = page->samples = 1.0, page->rows = 4294967295.0, page->bits = 1.0;
    if (at + 2 > bytes) return SIZE_MAX;
    const size_t tags = (size_t)voxel_number(b + at, 2, big);
    if (at + 2 + 12 * tags + 4 > bytes) return SIZE_MAX;
    for (size_t k = 0; k < tags; k++) {
        const unsigned char *tag = b + at + 2 + 12 * k;
        const int id = (int)voxel_number(tag, 2, big), type = (int)voxel_number(tag + 2, 2, big);
        const int wide = type == 3 ? 2 : type == 4 ? 4 : type == 1 ? 1 : 8;
        const size_t count = (size_t)voxel_number(tag + 4, 4, big);
        const size_t place = count * (size_t)wide <= 4 ? at + 2 + 12 * k + 8 : (size_t)voxel_number(tag + 8, 4, big);
        if ((id < 256 || id > 279) && id != 339) continue;
        if (wide == 8) continue;
        if (place > bytes || count > bytes || place + count * (size_t)wide > bytes) return SIZE_MAX;
        const double value = count > 0 ? (double)voxel_number(b + place, wide, big) : 0.0;
        switch (id) {
        case 256: page->width = value; break;
        case 257: page->height = value; break;
        case 258: page->bits = value; break;
        case 259: page->compression = value; break;
        case 262: page->inverted = value; break;
        case 273: page->offsets = place, page->strips = (double)count, page->of_offset = wide; break;
        case 277: page->samples = value; break;
        case 278: page->rows = value; break;
        case 279: page->counts = place, page->of_count = wide; break;
        default: break;
        }
    }
    return (size_t)voxel_number(b + at + 2 + 12 * tags, 4, big);
}

static inline int voxel_copy_page(const unsigned char *b, size_t bytes, int big, const voxel_page *p, float *to,
                                  char *message, size_t size) {
    const int wide = (int)p->bits / 8;
    const size_t row = (size_t)p->width * (size_t)wide;
    const double most = pow(2.0, p->bits) - 1.0;
    size_t y = 0;
    for (size_t s = 0; s < (size_t)p->strips && y < (size_t)p->height; s++) {
        const size_t from = (size_t)voxel_number(b + p->offsets + s * (size_t)p->of_offset, p->of_offset, big);
        for (size_t k = 0; k < (size_t)p->rows && y < (size_t)p->height; k++, y++) {
            if (from > bytes || from + (k + 1) * row > bytes)
                return voxel_fail(message, size, "a strip lies beyond the end of the file");
            for (size_t x = 0; x < (size_t)p->width; x++) {
                const double value = voxel_value(b + from + k * row + x * (size_t)wide, 'u', wide, big);
                *to++ = (float)(p->inverted == 0.0 ? most - value : value); /* 0 is white there */
            }
        }
    }
    return y == (size_t)p->height ? 0 : voxel_fail(message, size, "its strips have fewer rows than it says");
}

static inline int voxel_tif(const unsigned char *b, size_t bytes, voxel_image *m, char *message, size_t size) {
    if (bytes < 8 || (memcmp(b, "II*", 4) != 0 && memcmp(b, "MM\0*", 4) != 0))
        return voxel_fail(message, size,
                          bytes >= 4 && (b[2] == 43 || b[3] == 43) ? "a BigTIFF; save it as TIFF" : "no TIFF");
    const int big = b[0] == 'M';
    voxel_page first = {0}, page;
    double n[3] = {0.0, 0.0, 0.0};
    const size_t begin = (size_t)voxel_number(b + 4, 4, big);
    for (size_t at = begin, next; at != 0; at = next) { /* counts the pages */
        next = voxel_read_page(b, bytes, big, at, &page);
        if (next == SIZE_MAX) return voxel_fail(message, size, "page %.0f is cut off", n[2] + 1.0);
        if (n[2] == 0.0) first = page, n[0] = page.width, n[1] = page.height;
        if (page.compression != 1.0 || page.samples != 1.0 || (page.bits != 8.0 && page.bits != 16.0) ||
            page.strips < 1.0)
            return voxel_fail(message, size,
                              "page %.0f has compression %.0f, %.0f channels of %.0f bits; readable are strips without "
                              "compression (1), one channel of 8 or 16 bits",
                              n[2] + 1.0, page.compression, page.samples, page.bits);
        if (page.width != first.width || page.height != first.height)
            return voxel_fail(message, size, "page %.0f has another size than the first", n[2] + 1.0);
        if (++n[2] > 1e5 || (next != 0 && next <= at && next >= begin && next == begin))
            return voxel_fail(message, size, "its pages have no end");
    }
    if (n[2] == 0.0) return voxel_fail(message, size, "no page");
    if (voxel_make(m, n, message, size) != 0) return -1;
    float *to = m->value;
    for (size_t at = begin; at != 0; to += (size_t)n[0] * (size_t)n[1]) {
        const size_t next = voxel_read_page(b, bytes, big, at, &page);
        if (voxel_copy_page(b, bytes, big, &page, to, message, size) != 0) {
            free(m->value), m->value = NULL;
            return -1;
        }
        at = next;
    }
    return 0;
}

/* ---- ParaView image data ---- */

/* Finds name="..." between two places; copies the value. */
static inline int voxel_attribute(const char *from, const char *to, const char *name, char *value, size_t size) {
    const size_t length = strlen(name);
    for (const char *at = from; at + length + 2 < to; at++) {
        if (memcmp(at, name, length) != 0 || at[length] != '=' ||
            (at > from && at[-1] != ' ' && at[-1] != '\n' && at[-1] != '\t'))
            continue;
        const char quote = at[length + 1], *text = at + length + 2;
        size_t k = 0;
        while (text + k < to && text[k] != quote && k + 1 < size) value[k] = text[k], k++;
        value[k] = 0;
        return 1;
    }
    return 0;
}

static inline const char *voxel_find(const char *from, const char *end, const char *what) {
    const size_t length = strlen(what);
    for (; from && from + length <= end; from++)
        if (*from == *what && memcmp(from, what, length) == 0) return from;
    return NULL;
}

static inline int voxel_digit(char c) {
    return c >= 'A' && c <= 'Z'   ? c - 'A'
           : c >= 'a' && c <= 'z' ? c - 'a' + 26
           : c >= '0' && c <= '9' ? c - '0' + 52
           : c == '+'             ? 62
           : c == '/'             ? 63
                                  : -1;
}

/* Decodes base64 until something else; returns the number of bytes. Blocks may end with '=' and go on. */
static inline size_t voxel_base64(const char *from, const char *end, unsigned char *to, size_t room) {
    size_t count = 0;
    uint32_t bits = 0;
    int have = 0;
    for (; from < end && count < room; from++) {
        if (*from == '=') {
            have = 0;
            continue;
        }
        const int digit = voxel_digit(*from);
        if (digit < 0) {
            if (*from == ' ' || *from == '\n' || *from == '\r' || *from == '\t') continue;
            break;
        }
        bits = bits << 6 | (uint32_t)digit, have += 6;
        if (have >= 8) have -= 8, to[count++] = (unsigned char)(bits >> have & 255u);
    }
    return count;
}

/* The bytes of the array: decoded into room, or NULL with a message. */
static inline int voxel_vti_bytes(const char *text, const char *end, const char *array, const char *close,
                                  size_t wanted, int header, unsigned char *to, char *message, size_t size) {
    char format[20] = "ascii", offset[40] = "0", encoding[20] = "base64";
    voxel_attribute(array, close, "format", format, sizeof format),
        voxel_attribute(array, close, "offset", offset, sizeof offset);
    if (strcmp(format, "binary") == 0) {
        unsigned char *all = malloc(wanted + (size_t)header);
        const size_t got = all ? voxel_base64(close + 1, end, all, wanted + (size_t)header) : 0;
        if (got == wanted + (size_t)header) memcpy(to, all + header, wanted);
        free(all);
        return got == wanted + (size_t)header ? 0 : voxel_fail(message, size, "its array has fewer values than cells");
    }
    const char *appended = voxel_find(text, end, "<AppendedData"),
               *data = appended ? voxel_find(appended, end, "_") : NULL;
    if (strcmp(format, "appended") != 0 || !data)
        return voxel_fail(message, size, "an array of the format '%s'", format);
    voxel_attribute(appended, data, "encoding", encoding, sizeof encoding);
    const size_t skip = (size_t)strtoul(offset, NULL, 10);
    data += 1;
    if (skip > (size_t)(end - data)) return voxel_fail(message, size, "its array lies beyond the end of the file");
    data += skip;
    if (strcmp(encoding, "raw") == 0) {
        if ((size_t)(end - data) < wanted + (size_t)header)
            return voxel_fail(message, size, "its array has fewer values than cells");
        memcpy(to, data + header, wanted);
        return 0;
    }
    unsigned char *all = malloc(wanted + (size_t)header);
    const size_t got = all ? voxel_base64(data, end, all, wanted + (size_t)header) : 0;
    if (got == wanted + (size_t)header) memcpy(to, all + header, wanted);
    free(all);
    return got == wanted + (size_t)header ? 0 : voxel_fail(message, size, "its array has fewer values than cells");
}

/* name NULL: the first array of one component. */
static inline int voxel_vti(const char *text, size_t bytes, const char *name, voxel_image *m, char *message,
                            size_t size) {
    const char *end = text + bytes, *file = voxel_find(text, end, "<VTKFile"),
               *image = voxel_find(text, end, "<ImageData");
    char extent[120], spacing[120] = "0 0 0", kind[40], own[80], components[20], order[40] = "LittleEndian",
                      head[20] = "UInt32", none[20];
    double e[6], step[3] = {0.0, 0.0, 0.0}, n[3];
    if (!file || !image) return voxel_fail(message, size, "no ParaView image (ImageData)");
    const char *after_file = voxel_find(file, end, ">"), *after_image = voxel_find(image, end, ">");
    if (!after_file || !after_image) return voxel_fail(message, size, "cut off");
    voxel_attribute(file, after_file, "byte_order", order, sizeof order),
        voxel_attribute(file, after_file, "header_type", head, sizeof head);
    if (voxel_attribute(file, after_file, "compressor", none, sizeof none))
        return voxel_fail(message, size, "its data are compressed; save without");
    if (!voxel_attribute(image, after_image, "WholeExtent", extent, sizeof extent) ||
        sscanf(extent, "%lf %lf %lf %lf %lf %lf", &e[0], &e[1], &e[2], &e[3], &e[4], &e[5]) != 6)
        return voxel_fail(message, size, "no WholeExtent");
    voxel_attribute(image, after_image, "Spacing", spacing, sizeof spacing);
    sscanf(spacing, "%lf %lf %lf", &step[0], &step[1], &step[2]);
    const char *array = NULL, *close = NULL;
    for (const char *at = voxel_find(after_image, end, "<DataArray"); at && !array;
         at = voxel_find(at + 1, end, "<DataArray")) {
        close = voxel_find(at, end, ">");
        if (!close) return voxel_fail(message, size, "cut off");
        strcpy(components, "1"), strcpy(own, "");
        voxel_attribute(at, close, "NumberOfComponents", components, sizeof components),
            voxel_attribute(at, close, "Name", own, sizeof own);
        if (strcmp(components, "1") == 0 && (!name || strcmp(own, name) == 0)) array = at;
    }
    if (!array || !voxel_attribute(array, close, "type", kind, sizeof kind))
        return voxel_fail(message, size, "no array%s%s of one number a cell", name ? " " : "", name ? name : "");
    int of_points = 0;
    for (const char *at = voxel_find(after_image, array, "<PointData"); at;
         at = voxel_find(at + 1, array, "<PointData"))
        of_points = voxel_find(at, array, "</PointData") == NULL;
    for (int k = 0; k < 3; k++) n[k] = e[2 * k + 1] - e[2 * k] + (of_points ? 1.0 : 0.0);
    if (voxel_make(m, n, message, size) != 0) return -1;
    m->edge = fabs(step[0] - step[1]) <= 1e-6 * step[0] && fabs(step[0] - step[2]) <= 1e-6 * step[0] ? step[0] : 0.0;
    const size_t count = voxel_count(m);
    char format[20] = "ascii";
    voxel_attribute(array, close, "format", format, sizeof format);
    int status = 0;
    if (strcmp(format, "ascii") == 0) {
        const char *at = close + 1;
        for (size_t i = 0; i < count && status == 0; i++) {
            char *next;
            m->value[i] = strtof(at, &next);
            if (next == at) status = voxel_fail(message, size, "%zu values for %zu cells", i, count);
            at = next;
        }
    } else {
        const char letter = kind[0] == 'U' ? 'u' : kind[0] == 'I' ? 'i' : 'f';
        const int bits = atoi(kind + (letter == 'u' ? 4 : letter == 'i' ? 3 : 5)), wide = bits / 8;
        if (wide != 1 && wide != 2 && wide != 4 && wide != 8)
            status = voxel_fail(message, size, "an array of the type '%s'", kind);
        unsigned char *raw = status == 0 ? malloc(count * (size_t)wide) : NULL;
        if (status == 0 && !raw) status = voxel_fail(message, size, "out of memory");
        if (status == 0)
            status = voxel_vti_bytes(text, end, array, close, count * (size_t)wide, strcmp(head, "UInt64") == 0 ? 8 : 4,
                                     raw, message, size);
        for (size_t i = 0; i < count && status == 0; i++)
            m->value[i] = (float)voxel_value(raw + i * (size_t)wide, letter, wide, strcmp(order, "BigEndian") == 0);
        free(raw);
    }
    if (status != 0) free(m->value), m->value = NULL;
    return status;
}

#endif
