/* Reading STL files: facets from bytes, corners welded. */
#pragma once
#include "mesh_tree.h"

/* A slot of a hash table with open addressing: a 64-bit key, 0 if empty, and a number. The capacity is a power of two.
 */
typedef struct dem__slot {
    uint64_t key;
    int32_t value, forward, backward; /* edges: number of triangles that run along it each way */
} dem__slot;

static inline uint64_t dem__scramble(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline dem__slot *dem__find_slot(dem__slot *slots, size_t capacity, uint64_t key) {
    size_t at = (size_t)dem__scramble(key) & (capacity - 1);
    while (slots[at].key != 0 && slots[at].key != key) at = (at + 1) & (capacity - 1);
    return &slots[at];
}

/* A facet before welding. */
typedef struct dem__facet {
    dem_vec normal, corner[3];
} dem__facet;

static inline double dem__little_float(const unsigned char *byte) {
    const uint32_t bits =
        (uint32_t)byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* How many facets a binary file's header announces, and for how many it has bytes. */
typedef struct dem__binary_size {
    size_t announced, present, rest; /* rest: bytes after the last whole facet */
} dem__binary_size;
static inline dem__binary_size dem__size_of_binary(const unsigned char *bytes, size_t size) {
    dem__binary_size s;
    s.announced = (size_t)((uint32_t)bytes[80] | (uint32_t)bytes[81] << 8 | (uint32_t)bytes[82] << 16 |
                           (uint32_t)bytes[83] << 24);
    s.present = (size - 84) / 50, s.rest = (size - 84) % 50;
    return s;
}

/* Returns the number of facets to read: all that are present or, if the header announces fewer and the file does not
   end with a whole facet, those announced. */
static inline size_t dem__facets_of_binary(const dem__binary_size *s) {
    return s->announced < s->present && s->rest > 0 ? s->announced : s->present;
}

/* Counts what a binary file contains and what is missing. */
static inline void dem__count_binary(const unsigned char *bytes, size_t size, dem_stl_report *report) {
    const dem__binary_size s = dem__size_of_binary(bytes, size);
    const size_t n = dem__facets_of_binary(&s), missing = s.announced > n ? s.announced - n : 0;
    report->facets = (ptrdiff_t)n;
    report->missing = missing < PTRDIFF_MAX ? (ptrdiff_t)missing : PTRDIFF_MAX;
    report->unannounced = n > s.announced ? (ptrdiff_t)(n - s.announced) : 0;
    report->surplus = missing > 0 ? 0 : (ptrdiff_t)(size - 84 - 50 * n);
}

/* Reads facet k of a binary file: normal, three corners, two bytes. */
static inline void dem__read_facet(const unsigned char *bytes, size_t k, dem__facet *facet) {
    for (int a = 0; a < 12; a++) {
        dem_vec *to = a < 3 ? &facet->normal : &facet->corner[a / 3 - 1];
        *dem_axis_of(to, a % 3) = dem__little_float(bytes + 84 + 50 * k + 4 * a);
    }
}

/* Returns whether the bytes are coordinates: three in four facets have corners of 0 or between 1e-15 and 1e15. In other
   data (compressed, other byte order, two bytes a letter) hardly any facets do. */
static inline int dem__has_coordinates(const unsigned char *bytes, size_t size) {
    const dem__binary_size s = dem__size_of_binary(bytes, size);
    const size_t n = dem__facets_of_binary(&s);
    size_t good = 0;
    for (size_t k = 0; k < n; k++) {
        dem__facet f;
        int fits = 1;
        dem__read_facet(bytes, k, &f);
        for (int c = 0; c < 9; c++) {
            const double x = fabs(dem_axis(f.corner[c / 3], c % 3));
            fits &= x == 0.0 || (x > 1e-15 && x < 1e15);
        }
        good += (size_t)fits;
    }
    return good > 0 && good >= n - n / 4;
}

/* Finds the next word of a text; any white space ends it. Returns its length, 0 at the end. */
static inline size_t dem__word(const unsigned char *bytes, size_t size, size_t *at) {
    size_t length = 0;
    while (*at < size && bytes[*at] <= ' ') ++*at;
    while (*at + length < size && bytes[*at + length] > ' ') length++;
    return length;
}

/* Returns whether a word is `name`, in small or capital letters. */
static inline int dem__is_word(const unsigned char *bytes, size_t at, size_t length, const char *name) {
    size_t k = 0;
    for (; name[k]; k++) {
        const unsigned char c = k < length ? bytes[at + k] : 0;
        if ((c >= 'A' && c <= 'Z' ? c + 32 : c) != (unsigned char)name[k]) return 0;
    }
    return k == length;
}

/* Parses a decimal number, whatever the locale, to within an ulp or two. Returns NaN if it is not a number. */
static inline double dem__number(const unsigned char *text, size_t length) {
    size_t k = 0;
    int digits = 0, point = 0, exponent = 0, down = 0;
    uint64_t whole = 0; /* the first 18 digits */
    const int minus = length > 0 && text[0] == '-';
    if (length > 0 && (text[0] == '-' || text[0] == '+')) k++;
    for (; k < length && ((text[k] >= '0' && text[k] <= '9') || (text[k] == '.' && !point)); k++) {
        if (text[k] == '.') {
            point = 1;
            continue;
        }
        if (whole < 100000000000000000u) whole = 10u * whole + (uint64_t)(text[k] - '0'), exponent -= point;
        else exponent += !point;
        digits++;
    }
    if (digits && k < length &&
        (text[k] == 'e' || text[k] == 'E' || text[k] == 'd' || text[k] == 'D')) { /* d: Fortran's */
        int power = 0, any = 0;
        k++;
        if (k < length && (text[k] == '-' || text[k] == '+')) down = text[k++] == '-';
        for (; k < length && text[k] >= '0' && text[k] <= '9'; k++, any = 1)
            power = power < 10000 ? 10 * power + (text[k] - '0') : power;
        if (!any) return (double)NAN;
        exponent += down ? -power : power;
    }
    if (!digits || k != length) return (double)NAN;
    double ten = 1.0, base = 10.0; /* exact up to 10^22 */
    if (exponent < -400 || exponent > 400) exponent = exponent < 0 ? -400 : 400;
    for (int e = exponent < 0 ? -exponent : exponent; e > 0; e >>= 1, base *= base) ten *= e & 1 ? base : 1.0;
    const double value = whole == 0 ? 0.0 : (exponent < 0 ? (double)whole / ten : (double)whole * ten);
    return minus ? -value : value;
}

/* ---- text ---- */

enum { DEM__CORNERS_MAX = 64 }; /* of a facet; one with more counts as missing */

/* A text that is being read, and the facet in progress. */
typedef struct dem__stl_text {
    const unsigned char *bytes;
    size_t size, at;
    dem__facet *out; /* where triangles are written; NULL: they are only counted */
    ptrdiff_t triangles, polygons, missing;
    int begun, ended; /* whether a line "solid", a line "endsolid" was read */
    int inside, loops, corners, wanted,
        bad; /* in a facet: loops and corners so far, numbers to come, whether it is malformed */
    dem_vec normal, corner[DEM__CORNERS_MAX], number;
} dem__stl_text;

/* Returns whether a word begins with a name, as solid_name does. */
static inline int dem__begins_with(const unsigned char *bytes, size_t at, size_t length, const char *name) {
    const size_t n = strlen(name);
    return length >= n && dem__is_word(bytes, at, n, name);
}

/* Skips the rest of a line, whose words are a name or a comment. If a facet ends on it, the whole text is one line;
   then skips only the word. */
static inline void dem__skip_line(dem__stl_text *t, size_t length) {
    size_t end = t->at + length, word;
    while (end < t->size && t->bytes[end] != '\n' && t->bytes[end] != '\r') end++;
    for (size_t at = t->at + length; (word = dem__word(t->bytes, end, &at)) > 0; at += word) {
        if (!dem__is_word(t->bytes, at, word, "endfacet")) continue;
        t->at += length;
        return;
    }
    t->at = end;
}

/* Returns a corner from which a fan of triangles covers a polygon, -1 if there is none. */
static inline int dem__fan_start(const dem_vec *corner, int n) {
    dem_vec whole = dem_vec3(0.0, 0.0, 0.0);
    for (int k = 1; k + 1 < n; k++)
        whole = dem__add(whole, dem__cross(dem__sub(corner[k], corner[0]), dem__sub(corner[k + 1], corner[0])));
    const double size = dem__dot(whole, whole);
    if (n == 3 || size != size) return 0; /* coordinates that are not finite are counted later */
    for (int start = 0; start < n; start++) {
        int covers = 1;
        for (int k = 1; k + 1 < n && covers; k++) {
            const dem_vec a = corner[start], b = corner[(start + k) % n], c = corner[(start + k + 1) % n];
            covers = dem__dot(dem__cross(dem__sub(b, a), dem__sub(c, a)), whole) >= -1e-9 * size;
        }
        if (covers) return start;
    }
    return -1;
}

/* Ends the current facet. Keeps its triangles if it is complete. */
static inline void dem__end_facet(dem__stl_text *t) {
    const int n = t->corners,
              start = t->inside && !t->bad && t->wanted == 0 && n >= 3 ? dem__fan_start(t->corner, n) : -1;
    if (!t->inside) return;
    t->inside = 0;
    if (start < 0) {
        t->missing++;
        return;
    }
    for (int k = 1; k + 1 < n; k++, t->triangles++) {
        if (!t->out) continue;
        dem__facet *f = &t->out[t->triangles];
        f->normal = t->normal;
        f->corner[0] = t->corner[start], f->corner[1] = t->corner[(start + k) % n],
        f->corner[2] = t->corner[(start + k + 1) % n];
    }
    t->polygons += n > 3;
}

static inline void dem__begin_facet(dem__stl_text *t) {
    dem__end_facet(t);
    t->inside = 1;
    t->loops = t->corners = t->wanted = t->bad = 0;
    t->normal = dem_vec3(0.0, 0.0, 0.0);
}

/* Reads one word of a facet, which may be one of three numbers. */
static inline void dem__read_word_of_facet(dem__stl_text *t, size_t length) {
    const unsigned char *b = t->bytes;
    if (dem__is_word(b, t->at, length, "normal")) t->bad |= t->wanted > 0 || t->corners > 0, t->wanted = 6;
    else if (dem__is_word(b, t->at, length, "vertex"))
        t->bad |= t->wanted > 0 || t->corners == DEM__CORNERS_MAX, t->wanted = 3;
    else if (dem__is_word(b, t->at, length, "outer")) t->bad |= ++t->loops > 1; /* a hole in a face */
    else if (dem__is_word(b, t->at, length, "loop") || dem__is_word(b, t->at, length, "endloop"))
        t->bad |= t->wanted > 0;
    else if (t->wanted > 0) {
        *dem_axis_of(&t->number, (6 - t->wanted) % 3) = dem__number(b + t->at, length);
        t->wanted--;
        if (t->wanted == 3) t->normal = t->number, t->wanted = 0;
        else if (t->wanted == 0 && !t->bad) t->corner[t->corners++] = t->number;
    } else t->bad = 1;
}

/* Reads a text. A facet extends from "facet" to "endfacet" or the next "facet". Names and comments are ignored. */
static inline void dem__read_text(const unsigned char *bytes, size_t size, dem__facet *facets, dem_stl_report *report) {
    dem__stl_text t;
    memset(&t, 0, sizeof t);
    t.bytes = bytes, t.size = size, t.out = facets;
    t.at = size >= 3 && bytes[0] == 0xef && bytes[1] == 0xbb && bytes[2] == 0xbf ? 3 : 0; /* byte-order mark */
    for (size_t length; (length = dem__word(bytes, size, &t.at)) > 0;) {
        const size_t at = t.at;
        if (bytes[at] == '#' || dem__begins_with(bytes, at, length, "//")) dem__skip_line(&t, length);
        else if (dem__is_word(bytes, at, length, "facet")) dem__begin_facet(&t), t.ended = 0, t.at += length;
        else if (dem__is_word(bytes, at, length, "endfacet"))
            t.missing += !t.inside, dem__end_facet(&t), t.at += length;
        else if (dem__begins_with(bytes, at, length, "endsolid") ||
                 (!t.inside && dem__is_word(bytes, at, length, "end")))
            dem__end_facet(&t), t.ended = 1, dem__skip_line(&t, length);
        else if (t.inside) dem__read_word_of_facet(&t, length), t.at += length;
        else if (dem__begins_with(bytes, at, length, "solid")) t.begun = 1, t.ended = 0, dem__skip_line(&t, length);
        else t.at += length;
    }
    if (t.inside || (t.begun && !t.ended)) t.missing++; /* the file is cut off */
    report->facets = t.triangles, report->missing = t.missing, report->polygons = t.polygons;
}

/* ---- what a file is ---- */

enum { DEM__STL_UNKNOWN, DEM__STL_TEXT, DEM__STL_BINARY };

/* Tells what kind of file it is, from all bytes, because headers may be wrong. A text has hardly any control
   characters; a binary file has the length that its count gives. If these two disagree, the numbers must look like
   coordinates. */
static inline int dem__kind_of_stl(const unsigned char *bytes, size_t size) {
    dem_stl_report found;
    size_t controls = 0;
    int whole = 0;
    memset(&found, 0, sizeof found);
    for (size_t k = 0; k < size; k++) controls += bytes[k] < ' ' && !(bytes[k] >= '\t' && bytes[k] <= '\r');
    const int is_text = controls <= size / 20;
    if (size >= 84) {
        const dem__binary_size s = dem__size_of_binary(bytes, size);
        whole = s.present > 0 && s.present == s.announced && s.rest == 0;
    }
    if (is_text && !whole) return DEM__STL_TEXT;
    if (whole || is_text || (size >= 84 && dem__has_coordinates(bytes, size))) {
        if (is_text) dem__read_text(bytes, size, NULL, &found);
        return found.facets > 0 ? DEM__STL_TEXT : DEM__STL_BINARY;
    }
    dem__read_text(bytes, size, NULL, &found); /* padded with zeros, or damaged */
    return found.facets > 0 ? DEM__STL_TEXT : DEM__STL_UNKNOWN;
}

static inline void dem__count_facets(const unsigned char *bytes, size_t size, dem_stl_report *report) {
    const int kind = dem__kind_of_stl(bytes, size);
    report->binary = kind == DEM__STL_BINARY;
    if (kind == DEM__STL_BINARY) dem__count_binary(bytes, size, report);
    if (kind == DEM__STL_TEXT) dem__read_text(bytes, size, NULL, report);
}
