/* apng.h: a moving picture as an animated PNG, which pages and viewers show as they show any PNG: at most 255 colours,
   those of its first frame, and of each further frame only what has changed. For render.c alone; needs libpng.

   W3C, Portable Network Graphics (PNG) Specification, third edition (2025): acTL, fcTL, fdAT. */
#ifndef APNG_H
#define APNG_H

#include <png.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"

enum {
    APNG_BITS = 6,
    APNG_SIDE = 1 << APNG_BITS,
    APNG_BINS = APNG_SIDE * APNG_SIDE * APNG_SIDE,
    APNG_COLOURS = 255,
    APNG_CLEAR = 255
}; /* clear: as in the frame before */

typedef struct apng_bytes {
    unsigned char *at;
    size_t n, room;
    int failed;
} apng_bytes;

typedef struct apng {
    int width, height, rate, frames, colours;
    uint32_t sequence;
    unsigned char palette[APNG_COLOURS][3], nearest[APNG_BINS];
    unsigned char *shown, *now; /* [width height] places in the palette */
    apng_bytes body;            /* chunks of all frames */
} apng;

static void apng_add(apng_bytes *b, const void *from, size_t n) {
    if (b->n + n > b->room) {
        const size_t room = 2 * (b->n + n) + 4096;
        unsigned char *larger = realloc(b->at, room);
        if (!larger) b->failed = 1;
        else b->at = larger, b->room = room;
    }
    if (!b->failed && n) memcpy(b->at + b->n, from, n), b->n += n;
}

static void apng_number(apng_bytes *b, uint32_t v, int bytes) {
    for (int k = bytes - 1; k >= 0; k--) {
        const unsigned char c = (unsigned char)(v >> 8 * k);
        apng_add(b, &c, 1);
    }
}

/* Begins a chunk; returns its place for apng_end. */
static size_t apng_begin(apng_bytes *b, const char *type) {
    const size_t at = b->n;
    apng_number(b, 0, 4);
    apng_add(b, type, 4);
    return at;
}

/* Fills in the length and the check (CRC-32) of a chunk. */
static void apng_end(apng_bytes *b, size_t at) {
    uint32_t crc = 0xFFFFFFFFu;
    if (b->failed) return;
    const uint32_t length = (uint32_t)(b->n - at - 8);
    for (int k = 0; k < 4; k++) b->at[at + (size_t)k] = (unsigned char)(length >> (24 - 8 * k));
    for (size_t i = at + 4; i < b->n; i++) {
        crc ^= b->at[i];
        for (int k = 0; k < 8; k++) crc = crc & 1u ? 0xEDB88320u ^ crc >> 1 : crc >> 1;
    }
    apng_number(b, crc ^ 0xFFFFFFFFu, 4);
}

/* ---- colours ---- */

static int apng_place(int red, int green, int blue) { return (red << APNG_BITS | green) << APNG_BITS | blue; }
static int apng_bin(const unsigned char *rgb) {
    return apng_place(rgb[0] >> (8 - APNG_BITS), rgb[1] >> (8 - APNG_BITS), rgb[2] >> (8 - APNG_BITS));
}

typedef struct apng_box {
    int low[3], high[3]; /* of the first bits of a channel */
    double weight;
} apng_box;

/* Shrinks a box to the bins that are used. */
static void apng_fit(apng_box *b, const float *count) {
    apng_box in = *b;
    b->weight = 0.0;
    for (int c = 0; c < 3; c++) b->low[c] = APNG_SIDE, b->high[c] = -1;
    for (int r = in.low[0]; r <= in.high[0]; r++)
        for (int g = in.low[1]; g <= in.high[1]; g++)
            for (int u = in.low[2]; u <= in.high[2]; u++) {
                const float n = count[apng_place(r, g, u)];
                const int at[3] = {r, g, u};
                if (!(n > 0.0f)) continue;
                b->weight += (double)n;
                for (int c = 0; c < 3; c++) {
                    if (at[c] < b->low[c]) b->low[c] = at[c];
                    if (at[c] > b->high[c]) b->high[c] = at[c];
                }
            }
}

/* Halves the weight of a box across its longest side (median cut, Heckbert 1982). */
static void apng_cut(apng_box *b, apng_box *other, const float *count) {
    double slice[APNG_SIDE] = {0.0}, sum = 0.0;
    int c = 0, at;
    for (int k = 1; k < 3; k++)
        if (b->high[k] - b->low[k] > b->high[c] - b->low[c]) c = k;
    for (int r = b->low[0]; r <= b->high[0]; r++)
        for (int g = b->low[1]; g <= b->high[1]; g++)
            for (int u = b->low[2]; u <= b->high[2]; u++) {
                const int place[3] = {r, g, u};
                slice[place[c]] += (double)count[apng_place(r, g, u)];
            }
    for (at = b->low[c]; at < b->high[c] - 1 && sum + slice[at] < 0.5 * b->weight; at++) sum += slice[at];
    *other = *b;
    b->high[c] = at, other->low[c] = at + 1;
    apng_fit(b, count), apng_fit(other, count);
}

/* The palette of a frame, and the nearest of it for every colour. */
static void apng_choose(apng *a, const unsigned char *rgb, float *count) {
    apng_box box[APNG_COLOURS];
    const size_t pixels = (size_t)a->width * (size_t)a->height;
    int n = 1;
    for (size_t i = 0; i < pixels; i++) count[apng_bin(rgb + 3 * i)] += 1.0f;
    for (int k = 0; k < 3; k++) box[0].low[k] = 0, box[0].high[k] = APNG_SIDE - 1;
    apng_fit(&box[0], count);
    while (n < APNG_COLOURS) {
        int best = -1;
        double most = 0.0;
        for (int k = 0; k < n; k++) {
            int side = 0;
            for (int c = 0; c < 3; c++)
                if (box[k].high[c] - box[k].low[c] > side) side = box[k].high[c] - box[k].low[c];
            if (side * side * box[k].weight > most) most = side * side * box[k].weight, best = k;
        }
        if (best < 0) break;
        apng_cut(&box[best], &box[n++], count);
    }
    a->colours = n;
    for (int k = 0; k < n; k++)
        for (int c = 0; c < 3; c++)
            a->palette[k][c] = (unsigned char)((box[k].low[c] + box[k].high[c] + 1) * 128 / APNG_SIDE);
    for (int i = 0; i < APNG_BINS; i++) {
        const int wide = 256 / APNG_SIDE,
                  at[3] = {(i >> 2 * APNG_BITS) * wide + wide / 2, (i >> APNG_BITS) % APNG_SIDE * wide + wide / 2,
                           i % APNG_SIDE * wide + wide / 2};
        int least = 1 << 30;
        for (int k = 0; k < n; k++) {
            int d = 0;
            for (int c = 0; c < 3; c++) d += (at[c] - a->palette[k][c]) * (at[c] - a->palette[k][c]);
            if (d < least) least = d, a->nearest[i] = (unsigned char)k;
        }
    }
}

/* ---- frames ---- */

static void apng_take(png_structp png, png_bytep bytes, png_size_t n) { apng_add(png_get_io_ptr(png), bytes, n); }
static void apng_flushed(png_structp png) { (void)png; }

/* Compresses rows of a rectangle as a PNG of its own, whose data are then copied; 0, or -1. */
static int apng_compress(const apng *a, int x, int y, int width, int height, apng_bytes *to) {
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    png_color colours[APNG_COLOURS + 1] = {{0, 0, 0}}; /* those of the whole file count */
    if (!info || setjmp(png_jmpbuf(png))) {
        png_destroy_write_struct(&png, &info);
        return -1;
    }
    png_set_write_fn(png, to, apng_take, apng_flushed);
    png_set_IHDR(png, info, (png_uint_32)width, (png_uint_32)height, 8, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_PLTE(png, info, colours, APNG_COLOURS + 1);
    png_set_compression_level(png, 9);
    png_set_filter(png, 0, PNG_FILTER_NONE);
    png_write_info(png, info);
    for (int j = y; j < y + height; j++) png_write_row(png, a->now + (size_t)j * (size_t)a->width + x);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return to->failed ? -1 : 0;
}

/* Adds the data of a compressed picture to the body: as they are for the first frame. */
static void apng_copy(apng *a, const apng_bytes *from) {
    for (size_t at = 8; at + 12 <= from->n;) {
        const unsigned char *c = from->at + at;
        const size_t length = (size_t)c[0] << 24 | (size_t)c[1] << 16 | (size_t)c[2] << 8 | c[3];
        if (memcmp(c + 4, "IDAT", 4) == 0) {
            const size_t chunk = apng_begin(&a->body, a->frames ? "fdAT" : "IDAT");
            if (a->frames) apng_number(&a->body, a->sequence++, 4);
            apng_add(&a->body, c + 8, length);
            apng_end(&a->body, chunk);
        }
        at += length + 12;
    }
}

/* What differs from the frame before stands in `now`, the rest of it is clear. box: x, y, width, height of what
   differs. */
static void apng_difference(apng *a, const unsigned char *rgb, int box[4]) {
    int low[2] = {a->width, a->height}, high[2] = {-1, -1};
    for (int j = 0; j < a->height; j++)
        for (int i = 0; i < a->width; i++) {
            const size_t at = (size_t)j * (size_t)a->width + (size_t)i;
            const unsigned char v = a->nearest[apng_bin(rgb + 3 * at)];
            const int same = a->frames && a->shown[at] == v;
            a->now[at] = same ? APNG_CLEAR : v;
            a->shown[at] = v;
            if (same) continue;
            low[0] = i < low[0] ? i : low[0], high[0] = i > high[0] ? i : high[0];
            low[1] = j < low[1] ? j : low[1], high[1] = j > high[1] ? j : high[1];
        }
    if (high[0] < 0) low[0] = low[1] = high[0] = high[1] = 0;
    box[0] = low[0], box[1] = low[1], box[2] = high[0] - low[0] + 1, box[3] = high[1] - low[1] + 1;
}

/* All of one size. 0, or -1. */
static int apng_frame(apng *a, const unsigned char *rgb, int width, int height) {
    const size_t pixels = (size_t)width * (size_t)height;
    int box[4];
    if (!a->frames) {
        float *count = calloc(APNG_BINS, sizeof *count);
        a->width = width, a->height = height;
        a->shown = malloc(pixels), a->now = malloc(pixels);
        if (count && a->shown && a->now) apng_choose(a, rgb, count);
        else a->body.failed = 1;
        free(count);
    }
    if (a->body.failed || width != a->width || height != a->height) return -1;
    apng_difference(a, rgb, box);
    const size_t control = apng_begin(&a->body, "fcTL");
    apng_number(&a->body, a->sequence++, 4);
    apng_number(&a->body, (uint32_t)box[2], 4), apng_number(&a->body, (uint32_t)box[3], 4);
    apng_number(&a->body, (uint32_t)box[0], 4), apng_number(&a->body, (uint32_t)box[1], 4);
    apng_number(&a->body, 1, 2), apng_number(&a->body, (uint32_t)a->rate, 2); /* shown for 1 / rate seconds */
    apng_number(&a->body, 0, 1), apng_number(&a->body, 1, 1);                 /* stays; over the frame before */
    apng_end(&a->body, control);
    apng_bytes packed = {0};
    const int failed = apng_compress(a, box[0], box[1], box[2], box[3], &packed);
    if (!failed) apng_copy(a, &packed);
    free(packed.at);
    a->frames++;
    return failed || a->body.failed ? -1 : 0;
}

/* Writes the file and frees what frames have taken. */
static int apng_write(apng *a, const char *folder, const char *name) {
    apng_bytes head = {0};
    int status = -1;
    apng_add(&head, "\x89PNG\r\n\x1a\n", 8);
    size_t at = apng_begin(&head, "IHDR");
    apng_number(&head, (uint32_t)a->width, 4), apng_number(&head, (uint32_t)a->height, 4);
    apng_add(&head, "\x08\x03\0\0\0", 5);
    apng_end(&head, at);
    at = apng_begin(&head, "acTL");
    apng_number(&head, (uint32_t)a->frames, 4), apng_number(&head, 0, 4); /* for ever */
    apng_end(&head, at);
    at = apng_begin(&head, "PLTE");
    apng_add(&head, a->palette, sizeof a->palette);
    apng_add(&head, "\xff\xff\xff", 3);
    apng_end(&head, at);
    at = apng_begin(&head, "tRNS");
    for (int k = 0; k <= APNG_CLEAR; k++) apng_number(&head, k == APNG_CLEAR ? 0 : 255, 1);
    apng_end(&head, at);
    at = apng_begin(&a->body, "IEND");
    apng_end(&a->body, at);
    riddle_io_file *file = head.failed || a->body.failed || !a->frames ? NULL : riddle_io_open(folder, name);
    if (file) {
        riddle_io_write(file, head.at, head.n);
        riddle_io_write(file, a->body.at, a->body.n);
        status = (int)riddle_io_close(file);
    }
    free(head.at), free(a->body.at), free(a->shown), free(a->now);
    return status;
}

#endif
