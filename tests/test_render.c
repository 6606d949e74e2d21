/* render.h: spheres and triangles stand where the camera sees them, nothing that is not finite is drawn,
   files are whole. */
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common.h"
#include "letters.h"

enum { W = 240, H = 160 };
static unsigned char rgb[H][W][3];
static const double ahead[3] = {0.0, 1.0, 0.0};
static const picture_colour red = {220, 20, 20}, green = {20, 200, 20};

/* How many pixels are mostly of a colour's channel, and the middle between the outermost. */
static int count(int channel, double *x, double *y) {
    int n = 0, low[2] = {W, H}, high[2] = {0, 0};
    for (int j = 0; j < H; j++)
        for (int i = 0; i < W; i++) {
            const unsigned char *p = rgb[j][i];
            if (p[channel] > 2 * p[(channel + 1) % 3] && p[channel] > 2 * p[(channel + 2) % 3]) {
                n++;
                low[0] = i < low[0] ? i : low[0], high[0] = i > high[0] ? i : high[0];
                low[1] = j < low[1] ? j : low[1], high[1] = j > high[1] ? j : high[1];
            }
        }
    *x = 0.5 * (low[0] + high[0] + 1), *y = 0.5 * (low[1] + high[1] + 1);
    return n;
}

static void test_a_sphere_is_round_and_in_the_middle(void **state) {
    (void)state;
    const double centre[3] = {3.0, 4.0, 5.0};
    double x, y;
    picture *p = picture_new(W, H);
    picture_sphere(p, centre, 0.5, red);
    picture_look(p, ahead);
    assert_int_equal(picture_draw(p, &rgb[0][0][0]), 0);
    const int n = count(0, &x, &y);
    assert_true(fabs(x - 0.5 * W) < 3.0 && fabs(y - 0.5 * H) < 3.0);
    const double radius = sqrt(n / 3.14159265358979); /* the whole height, less the margins */
    assert_true(radius > 0.33 * H && radius < 0.5 * H);
    picture_free(p);
}

/* The nearer sphere hides the other; right is right and up is up. */
static void test_near_and_far(void **state) {
    (void)state;
    double near[3] = {0, 0, 0}, far[3] = {0, 2, 0}, x, y, x2, y2;
    picture *p = picture_new(W, H);
    picture_sphere(p, far, 0.5, green);
    picture_sphere(p, near, 0.6, red);
    picture_look(p, ahead);
    assert_int_equal(picture_draw(p, &rgb[0][0][0]), 0);
    assert_true(count(0, &x, &y) > 500);
    assert_int_equal(count(1, &x2, &y2), 0);
    picture_clear(p);
    assert_true(picture_is_empty(p));
    far[0] = 1.5, far[2] = 1.0;
    picture_sphere(p, far, 0.5, green);
    picture_sphere(p, near, 0.6, red);
    picture_look(p, ahead);
    assert_int_equal(picture_draw(p, &rgb[0][0][0]), 0);
    assert_true(count(0, &x, &y) > 300 && count(1, &x2, &y2) > 100);
    assert_true(x2 > x + 10.0 && y2 < y - 10.0);
    picture_free(p);
}

/* A triangle behind is opaque whatever it is made of, one before it only when it is solid. */
static void test_glass(void **state) {
    (void)state;
    const double centre[3] = {0, 0, 0}, a[3] = {-3, -1, -3}, b[3] = {3, -1, -3}, c[3] = {0, -1, 4};
    double x, y;
    int seen[2];
    for (int kind = PICTURE_SOLID; kind <= PICTURE_GLASS; kind++) {
        picture *p = picture_new(W, H);
        const double before[3] = {0, -2, 0}, behind[3] = {0, 3, 0};
        picture_sphere(p, centre, 0.5, red);
        picture_sphere(p, behind, 0.1, red);
        picture_sphere(p, before, 1e-3, red); /* the middle of the scene lies between */
        picture_triangle(p, a, b, c, picture_glass(), kind);
        picture_look(p, ahead);
        assert_int_equal(picture_draw(p, &rgb[0][0][0]), 0);
        seen[kind] = count(0, &x, &y);
        picture_free(p);
    }
    assert_true(seen[PICTURE_SOLID] < 10);
    assert_true(seen[PICTURE_GLASS] > 100);
}

static void test_hostile(void **state) {
    (void)state;
    const double values[] = {0.0, 1e-300, 1e300, -1e300, (double)NAN, HUGE_VAL, 1.0};
    picture *p = picture_new(W, H);
    assert_int_equal(picture_draw(p, &rgb[0][0][0]), 0); /* empty */
    for (int i = 0; i < 7; i++)
        for (int k = 0; k < 7; k++) {
            const double at[3] = {values[i], values[k], 0.0}, other[3] = {values[k], 1.0, values[i]};
            picture_sphere(p, at, values[i], red);
            picture_triangle(p, at, other, ahead, red, k % 2);
            picture_clear(i == 6 ? p : NULL);
        }
    const double no_direction[3] = {0, 0, 0}, bad[3] = {(double)NAN, 0, 0};
    picture_look(p, no_direction);
    assert_int_equal(picture_draw(p, &rgb[0][0][0]), 0);
    picture_look(p, bad);
    picture_title(p, "\x01\xff ~");
    for (int k = 0; k < 20; k++)
        picture_legend(p, "too many rows of the legend, each too long for the width of the picture that it stands in",
                       red);
    picture_bar(p, "speed [m/s]", (double)NAN);
    assert_int_equal(picture_draw(p, &rgb[0][0][0]), 0);
    picture_free(p);
    assert_null(picture_new(3, 100000));
    picture_sphere(NULL, ahead, 1.0, red);
    picture_look(NULL, ahead);
    picture_free(NULL);
    assert_int_equal(picture_draw(NULL, &rgb[0][0][0]), -1);
    movie_add(NULL, NULL);
    assert_int_equal(movie_close(NULL), 0);
}

static unsigned number_at(const unsigned char *c) {
    return (unsigned)c[0] << 24 | (unsigned)c[1] << 16 | (unsigned)c[2] << 8 | c[3];
}

/* An animated PNG: as many frames as were added, numbered in order, every chunk with its check; a frame like the one
   before takes next to nothing, and one box of what has changed. */
static void test_animation(void **state) {
    (void)state;
    static unsigned char bytes[200000];
    char folder[300], path[400];
    double centre[3] = {0, 0, 0}, other[3] = {4, 0, 0};
    size_t size[4] = {0}, n;
    unsigned frames = 0, sequence = 0, box[4][4];
    snprintf(folder, sizeof folder, "%s", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
    snprintf(path, sizeof path, "%s/riddle-animation.png", folder);
    picture *p = picture_new(W, H);
    movie *m = movie_open(folder, "riddle-animation.png", 12);
    for (int k = 0; k < 4 && m; k++) { /* the third as the second */
        centre[0] = k < 1 ? 0.0 : k < 3 ? 0.3 : 0.4;
        picture_clear(p);
        picture_sphere(p, centre, 1.0, red), picture_sphere(p, other, 1.0, green);
        if (k == 0) picture_look(p, ahead);
        movie_add(m, p);
    }
    picture_free(p);
    assert_int_equal(movie_close(m), 0);
    if (!m) skip(); /* built without libpng */
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    n = fread(bytes, 1, sizeof bytes, f);
    fclose(f), remove(path);
    assert_true(n > 8 && n < sizeof bytes && memcmp(bytes + n - 8, "IEND", 4) == 0);
    for (size_t at = 8; at < n;) {
        const unsigned char *c = bytes + at;
        const unsigned length = number_at(c);
        unsigned long crc = 0xFFFFFFFFul;
        for (unsigned i = 0; i < length + 4; i++) {
            crc ^= c[4 + i];
            for (int k = 0; k < 8; k++) crc = crc >> 1 ^ (crc & 1ul ? 0xEDB88320ul : 0ul);
        }
        assert_int_equal(number_at(c + 8 + length), crc ^ 0xFFFFFFFFul);
        if (memcmp(c + 4, "acTL", 4) == 0) assert_int_equal(number_at(c + 8), 4);
        if (memcmp(c + 4, "fcTL", 4) == 0 || memcmp(c + 4, "fdAT", 4) == 0)
            assert_int_equal(number_at(c + 8), sequence++);
        if (memcmp(c + 4, "fcTL", 4) == 0) {
            assert_true(frames < 4);
            for (int k = 0; k < 4; k++) box[frames][k] = number_at(c + 12 + 4 * k);
            assert_true(c[28] == 0 && c[29] == 1 && c[30] == 0 && c[31] == 12); /* a twelfth of a second */
            frames++;
        } else if (memcmp(c + 5, "DAT", 3) == 0) size[frames - 1] += length;
        at += length + 12;
    }
    assert_int_equal(frames, 4);
    assert_true(box[0][0] == W && box[0][1] == H && box[2][0] == 1 && box[2][1] == 1);
    for (int k = 1; k < 4; k += 2) assert_true(box[k][0] < W / 2 && box[k][2] + box[k][0] < W / 2 + 20);
    assert_true(size[2] < 40 && size[1] < size[0]);
}

/* ---- letters ---- */

enum { PAPER = 300 };
static double ink[PAPER][PAPER];
static int low_row, high_row; /* of what is inked at least half */

static void put(void *user, int x, int y, double share) {
    (void)user;
    assert_true(share > 0.0 && share <= 1.0);
    if (x < 0 || y < 0 || x >= PAPER || y >= PAPER) return;
    ink[y][x] += share;
    if (share >= 0.5) low_row = y < low_row ? y : low_row, high_row = y > high_row ? y : high_row;
}

/* Area of a text's ink [pixels]; *width of the text. */
static double inked(const char *text, double x, double y, double size, double *width) {
    const letters_target to = {put, NULL};
    double sum = 0.0;
    memset(ink, 0, sizeof ink);
    low_row = PAPER, high_row = -1;
    *width = letters_draw(&to, x, y, size, text);
    for (int j = 0; j < PAPER; j++)
        for (int i = 0; i < PAPER; i++) sum += ink[j][i];
    return sum;
}

/* A capital is as high as asked; area and width go with the size, whatever the place between two pixels. */
static void test_letters_have_their_size(void **state) {
    (void)state;
    static const char *const texts[] = {"H", "O", "g", "\xc3\xa9", "8", "\xc2\xb5m", "@"};
    double w, v;
    inked("H", 20.0, 200.0, 100.0, &w);
    assert_true(low_row == 100 && high_row == 199);
    inked("O", 20.0, 200.0, 100.0, &w);
    assert_true(ink[150][20 + (int)(0.5 * w)] == 0.0 && ink[150][34] > 0.9); /* a hole in a ring */
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        const double large = inked(texts[k], 20.0, 150.0, 80.0, &w), small = inked(texts[k], 20.3, 150.6, 20.0, &v);
        assert_true(small > 20.0 && fabs(large / small - 16.0) < 0.05);
        assert_true(fabs(w / v - 4.0) < 1e-9);
    }
}

static void test_letters_of_the_signs(void **state) {
    (void)state;
    static const char *const signs[] = {"\xc2\xb1", "\xc2\xb5", "\xc2\xb0",     "\xc2\xb2",
                                        "\xc2\xb3", "\xce\xbc", "\xe2\x89\xa4", "\xe2\x88\x92"};
    double w, none;
    const double space = letters_width(" ", 20.0);
    for (size_t k = 0; k < sizeof signs / sizeof *signs; k++) assert_true(inked(signs[k], 20.0, 100.0, 20.0, &w) > 5.0);
    for (int c = 33; c < 127; c++) {
        const char text[2] = {(char)c, '\0'};
        assert_true(inked(text, 20.0, 100.0, 20.0, &w) > 5.0);
    }
    assert_true(inked("a", 20.0, 100.0, 20.0, &w) < inked("\xc3\xa4", 20.0, 100.0, 20.0, &none)); /* with its dots */
    assert_true(fabs(w - none) < 1e-12);
    /* Damaged; not in the font. */
    static const char *const odd[] = {"\xe2\x82", "\xff", "\x80", "\xc3", "\xf0\x9f\x92\xa9", "\xe4\xb8\xad"};
    for (size_t k = 0; k < sizeof odd / sizeof *odd; k++) {
        assert_true(inked(odd[k], 20.0, 100.0, 20.0, &none) == 0.0);
        assert_true(none >= 0.999 * space && none <= 2.001 * space);
    }
}

static void test_file(void **state) {
    (void)state;
    char name[300];
    snprintf(name, sizeof name, "%s/riddle-render.%ld.png", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp",
             (long)getpid());
    picture *p = picture_new(W, H);
    picture_sphere(p, ahead, 0.5, red);
    const int status = picture_write(p, NULL, name);
    picture_free(p);
    FILE *f = fopen(name, "rb");
    assert_int_equal(status, f ? 0 : 1);
    if (!f) skip(); /* built without libpng */
    unsigned char head[24];
    assert_int_equal(fread(head, 1, 24, f), 24);
    fclose(f);
    remove(name);
    assert_memory_equal(head, "\x89PNG\r\n\x1a\n", 8);
    assert_int_equal(head[18] * 256 + head[19], W);
    assert_int_equal(head[22] * 256 + head[23], H);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_sphere_is_round_and_in_the_middle),
        cmocka_unit_test(test_near_and_far),
        cmocka_unit_test(test_glass),
        cmocka_unit_test(test_hostile),
        cmocka_unit_test(test_animation),
        cmocka_unit_test(test_letters_have_their_size),
        cmocka_unit_test(test_letters_of_the_signs),
        cmocka_unit_test(test_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
