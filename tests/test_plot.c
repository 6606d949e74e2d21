/* The SVG figures: data stand where the axes say, the text is well-formed whatever the data are, the legend keeps
   off the data. */
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common.h"

static char path[300];

/* Writes the figure, returns it as text (the caller frees it) and removes the file. */
static char *drawn(riddle_plot *p) {
    snprintf(path, sizeof path, "%s/riddle-plot.%ld.svg", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp", (long)getpid());
    assert_int_equal(riddle_plot_write(p, NULL, path), 0);
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    fseek(f, 0, SEEK_END);
    long size = ftell(f);
    rewind(f);
    char *text = malloc((size_t)size + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, (size_t)size, f), size);
    text[size] = '\0';
    fclose(f);
    remove(path);
    return text;
}

/* Tags balanced, entities known, no number that is none. */
static void expect_well_formed(const char *text) {
    char stack[20][16];
    int depth = 0;
    for (const char *c = text; *c; c++) {
        if (*c == '&')
            assert_true(strncmp(c, "&amp;", 5) == 0 || strncmp(c, "&lt;", 4) == 0 || strncmp(c, "&gt;", 4) == 0);
        if (*c != '<') continue;
        const char *end = strchr(c, '>');
        assert_non_null(end);
        if (c[1] == '/') {
            assert_true(depth > 0);
            size_t length = strlen(stack[--depth]);
            assert_memory_equal(c + 2, stack[depth], length);
            assert_int_equal(c[2 + length], '>');
        } else if (end[-1] != '/') {
            assert_true(depth < 20);
            snprintf(stack[depth++], 16, "%.*s", (int)strcspn(c + 1, " >"), c + 1);
        }
        int quotes = 0;
        for (const char *k = c; k < end; k++) quotes += *k == '"';
        assert_int_equal(quotes % 2, 0);
        for (const char *k = c; k < end; k++)
            if (strncmp(k, "nan", 3) == 0 || strncmp(k, "inf", 3) == 0) fail_msg("a number is none: %.80s", c);
        c = end;
    }
    assert_int_equal(depth, 0);
}

/* x, y, width, height of the n-th <rect ... class="frame">. */
static void frame(const char *text, double box[4]) {
    const char *at = strstr(text, "class=\"frame\"");
    assert_non_null(at);
    while (at > text && *at != '<') at--;
    assert_int_equal(
        sscanf(at, "<rect x=\"%lf\" y=\"%lf\" width=\"%lf\" height=\"%lf\"", &box[0], &box[1], &box[2], &box[3]), 4);
}

static bool has_tick(const char *text, const char *label) {
    char key[100];
    snprintf(key, sizeof key, "class=\"tick\">%s</text>", label);
    return strstr(text, key) != NULL;
}

static void test_data_stand_on_the_axes(void **state) {
    (void)state;
    double x[] = {0.0, 10.0, 5.0}, y[] = {-1.0, 1.0, 0.5}, box[4], cx, cy;
    riddle_plot *p = riddle_plot_new("T & <co>", 1, 1);
    riddle_plot_panel(p, 0, 0, "time [s]", "height [m]");
    riddle_plot_range_x(p, 0.0, 10.0);
    riddle_plot_range_y(p, -1.0, 1.0);
    riddle_plot_points(p, "a", x, y, 3);
    char *text = drawn(p);
    expect_well_formed(text);
    frame(text, box);
    const char *at = text;
    for (int i = 0; i < 3; i++) {
        at = strstr(at + 1, "<circle");
        assert_non_null(at);
        assert_int_equal(sscanf(at, "<circle cx=\"%lf\" cy=\"%lf\"", &cx, &cy), 2);
        assert_true(fabs(cx - (box[0] + box[2] * x[i] / 10.0)) < 0.1);
        assert_true(fabs(cy - (box[1] + box[3] * (1.0 - y[i]) / 2.0)) < 0.1);
    }
    assert_true(has_tick(text, "0") && has_tick(text, "2") && has_tick(text, "10") && has_tick(text, "0.4") &&
                has_tick(text, "\xE2\x88\x92"
                               "1.0"));
    assert_non_null(strstr(text, ">time [s]</text>"));
    assert_non_null(strstr(text, ">height [m]</text>"));
    assert_non_null(strstr(text, "T &amp; &lt;co&gt;"));
    free(text);
}

static void test_log_axes(void **state) {
    (void)state;
    double x[] = {1e-6, 1e-4, 0.0, -1.0}, y[] = {1.0, 100.0, 1.0, 1.0}, box[4], cx, cy;
    riddle_plot *p = riddle_plot_new(NULL, 1, 1);
    riddle_plot_panel(p, 0, 0, "error [-]", "time [s]");
    riddle_plot_log_x(p);
    riddle_plot_log_y(p);
    riddle_plot_range_x(p, 1e-8, 1.0);
    riddle_plot_points(p, NULL, x, y, 4);
    char *text = drawn(p);
    expect_well_formed(text);
    frame(text, box);
    const char *at = strstr(text, "<circle");
    assert_int_equal(sscanf(at, "<circle cx=\"%lf\" cy=\"%lf\"", &cx, &cy), 2);
    assert_true(fabs(cx - (box[0] + box[2] * 0.25)) < 0.1);
    at = strstr(strstr(at + 1, "<circle"), "<circle");
    assert_int_equal(sscanf(at, "<circle cx=\"%lf\" cy=\"%lf\"", &cx, &cy), 2);
    assert_true(fabs(cx - (box[0] + box[2] * 0.5)) < 0.1);
    assert_null(strstr(at + 1, "<circle")); /* zero and the negative one cannot stand there */
    assert_non_null(strstr(text, "10<tspan class=\"up\" dy=\"-6\">\xE2\x88\x92"
                                 "6</tspan>"));
    assert_true(has_tick(text, "1") && has_tick(text, "10") && has_tick(text, "100"));
    free(text);
}

static void test_small_numbers_share_an_exponent(void **state) {
    (void)state;
    double x[] = {0.0, 1.9e-5}, y[] = {-2.5e6, 3e6};
    riddle_plot *p = riddle_plot_new(NULL, 1, 1);
    riddle_plot_panel(p, 0, 0, "gap [m]", "pressure [Pa]");
    riddle_plot_line(p, NULL, x, y, 2);
    char *text = drawn(p);
    expect_well_formed(text);
    assert_true(has_tick(text, "5") && has_tick(text, "10") &&
                has_tick(text, "\xE2\x88\x92"
                               "2"));
    assert_non_null(strstr(text, "\xC3\x97"
                                 "10<tspan class=\"up\" dy=\"-6\">\xE2\x88\x92"
                                 "6</tspan>"));
    assert_non_null(strstr(text, "\xC3\x97"
                                 "10<tspan class=\"up\" dy=\"-6\">6</tspan>"));
    free(text);
}

/* Every kind of series with every kind of number: whole text, finite coordinates. */
static void test_hostile_data(void **state) {
    (void)state;
    double nan = (double)NAN, inf = HUGE_VAL;
    double sets[][4] = {{0, 0, 0, 0},
                        {nan, nan, nan, nan},
                        {inf, -inf, nan, 1},
                        {1e308, -1e308, 0, 1},
                        {DBL_MAX, DBL_MAX, 1, 2},
                        {4.9e-324, 1e-300, 0, 1},
                        {1, 1, 1, 1},
                        {-5, -5, -5, -5},
                        {1e15, 1e15 + 1, 1e15, 1},
                        {1, 2, nan, 4},
                        {1e-12, 2e-12, 3e-12, 4e-12},
                        {99999, 100001, 100000, 99998}};
    static const char *const names[] = {"a", "a <very> long & name of a group", "", "b"};
    int n_sets = (int)(sizeof sets / sizeof *sets);
    for (int i = 0; i < n_sets; i++)
        for (int k = 0; k < n_sets; k++)
            for (int kind = 0; kind < 8; kind++) {
                const double *x = sets[i], *y = sets[k];
                riddle_plot *p = riddle_plot_new("hostile", 1, 1);
                riddle_plot_panel(p, 0, 0, "x [m]", "y [m]");
                if (kind & 1) riddle_plot_log_x(p);
                if (kind & 2) riddle_plot_log_y(p);
                if (kind & 4) riddle_plot_equal(p);
                if (kind == 6) riddle_plot_scale_bar(p, "m");
                riddle_plot_line(p, "line", x, y, 4);
                riddle_plot_style(p, RIDDLE_PLOT_MARKED | RIDDLE_PLOT_DASHED | RIDDLE_PLOT_STEPS, RIDDLE_PLOT_NEXT);
                riddle_plot_band(p, "band", x, y, x, 4);
                riddle_plot_error_bars(p, "bars", x, y, x, 4);
                riddle_plot_discs(p, "discs", x, y, x, 4);
                riddle_plot_horizontal(p, "h", y[0]);
                riddle_plot_vertical(p, "v", x[1]);
                riddle_plot_text(p, x[2], y[2], "text");
                if (kind == 0) riddle_plot_bars(p, "bars", names, y, 4);
                if (kind == 3) riddle_plot_heat(p, "heat", y, 2, 2, x[0], x[1], x[2], x[3]);
                if (kind == 3 && i % 2) riddle_plot_heat_range(p, x[3], y[3]);
                char *text = drawn(p);
                expect_well_formed(text);
                free(text);
            }
}

/* A panel to scale has no axes, and a bar that is as long as it says, whatever the shape of the panel; NULL brings the
   axes back. */
static void test_scale_bar(void **state) {
    (void)state;
    static const double scales[] = {1e-3, 1.0, 37.0, 4e5};
    for (int k = 0; k < 8; k++) {
        const double unit = scales[k % 4], x[] = {unit, 3.0 * unit}, y[] = {unit, 1.5 * unit},
                     r[] = {0.5 * unit, 0.1 * unit};
        double cx[2], length, shown;
        riddle_plot *p = riddle_plot_new(NULL, 1, 1);
        riddle_plot_panel_size(p, k < 4 ? 700.0 : 300.0, k < 4 ? 200.0 : 500.0);
        riddle_plot_panel(p, 0, 0, "x [mm]", "z [mm]");
        riddle_plot_scale_bar(p, "m<m");
        riddle_plot_discs(p, NULL, x, y, r, 2);
        char *text = drawn(p), *at = text;
        expect_well_formed(text);
        assert_true(!strstr(text, "class=\"frame\"") && !strstr(text, "x [mm]") && !strstr(text, "class=\"grid\""));
        for (int i = 0; i < 2; i++)
            assert_int_equal(sscanf(at = strstr(at + 1, "<circle"), "<circle cx=\"%lf\"", &cx[i]), 1);
        assert_non_null(at = strstr(at, "class=\"bar\""));
        assert_int_equal(sscanf(strchr(at, 'h'), "h%lf", &length), 1);
        assert_non_null(at = strstr(at, "class=\"tick\">"));
        assert_int_equal(sscanf(at, "class=\"tick\">%lf m&lt;m<", &shown), 1);
        assert_true(fabs(length / shown / ((cx[1] - cx[0]) / (2.0 * unit)) - 1.0) < 1e-3);
        assert_true(length > 0.09 * (k < 4 ? 700.0 : 300.0) && length <= 0.2501 * (k < 4 ? 700.0 : 300.0));
        free(text);
    }
    riddle_plot_scale_bar(NULL, "mm");
    riddle_plot *p = riddle_plot_new(NULL, 1, 1);
    riddle_plot_panel(p, 0, 0, "x [mm]", "z [mm]");
    riddle_plot_scale_bar(p, "mm");
    riddle_plot_scale_bar(p, NULL);
    char *text = drawn(p);
    assert_true(strstr(text, "class=\"frame\"") && strstr(text, "x [mm]") && !strstr(text, "class=\"bar\""));
    free(text);
}

static void test_wrong_calls(void **state) {
    (void)state;
    riddle_plot_panel(NULL, 0, 0, "x", "y");
    riddle_plot_line(NULL, "a", NULL, NULL, 0);
    riddle_plot_style(NULL, 0, 0);
    riddle_plot_free(NULL);
    assert_int_not_equal(riddle_plot_write(NULL, NULL, "x"), 0);
    riddle_plot *p = riddle_plot_new("empty", 100, -3);
    riddle_plot_style(p, 0, RIDDLE_PLOT_SAME); /* nothing to style */
    riddle_plot_panel(p, 50, 0, "x", "y");
    riddle_plot_range_x(p, 1.0, 1.0);
    riddle_plot_range_y(p, (double)NAN, 1.0);
    riddle_plot_line(p, NULL, NULL, NULL, -5);
    riddle_plot_heat(p, NULL, NULL, 0, 0, 0, 1, 0, 1);
    riddle_plot_heat_range(p, 0.0, 1.0); /* no heat map to colour */
    riddle_plot_heat_range(NULL, 0.0, 1.0);
    riddle_plot_heat_classes(p, NULL, 3);
    riddle_plot_heat_classes(NULL, NULL, 3);
    riddle_plot_panel_size(p, 1e9, -1.0);
    char *text = drawn(p);
    expect_well_formed(text);
    free(text);
    assert_int_not_equal(riddle_plot_write(riddle_plot_new("x", 1, 1), "/dev/null", "x.svg"), 0);
}

/* A heat map of classes has their names, and no number, beside its colours; the label of a vertical line that has no
   room on either side stands along it. */
static void test_classes_and_long_labels(void **state) {
    (void)state;
    const double values[4] = {0.0, 1.0, 2.0, 1.0};
    const char *const names[3] = {"rebound", "Type <I>", "Type II"};
    riddle_plot *p = riddle_plot_new(NULL, 1, 1);
    riddle_plot_panel(p, 0, 0, "x", "y");
    riddle_plot_heat(p, "", values, 2, 2, 0.0, 1.0, 0.0, 1.0);
    riddle_plot_heat_classes(p, names, 3);
    riddle_plot_heat_classes(p, names, 3); /* once is enough */
    char *text = drawn(p);
    expect_well_formed(text);
    assert_non_null(strstr(text, ">rebound<"));
    assert_non_null(strstr(text, "Type &lt;I&gt;"));
    assert_null(strstr(text, ">1.5<"));
    free(text);
    for (int length = 1; length <= 2; length++) {
        const double x[2] = {0.0, 1.0};
        p = riddle_plot_new(NULL, 1, 1);
        riddle_plot_panel(p, 0, 0, "x", "y");
        riddle_plot_line(p, NULL, x, x, 2);
        riddle_plot_vertical(p, length == 1 ? "short" : "a label that is much longer than half of a panel can be", 0.5);
        text = drawn(p);
        expect_well_formed(text);
        assert_true((strstr(text, "rotate(90)") != NULL) == (length == 2));
        free(text);
    }
}

/* Sixteen lines, with markers and without: no two look the same in the legend. */
static void test_many_lines_differ(void **state) {
    (void)state;
    enum { LINES = 16 };
    const double x[2] = {0.0, 1.0};
    for (int marked = 0; marked < 2; marked++) {
        char look[LINES][200];
        riddle_plot *p = riddle_plot_new(NULL, 1, 1);
        riddle_plot_panel(p, 0, 0, "x", "y");
        for (int k = 0; k < LINES; k++) {
            const double y[2] = {k, k + 1.0};
            riddle_plot_line(p, NULL, x, y, 2);
            if (marked) riddle_plot_style(p, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
        }
        char *text = drawn(p), *at = text;
        expect_well_formed(text);
        for (int k = 0; k < LINES; k++) { /* colour and dash of the line, shape of its first marker */
            at = strstr(at + 1, "<path fill=\"none\"");
            assert_non_null(at);
            const int line = (int)(strstr(at, " d=") - at);
            const char *marker = marked ? strchr(strstr(at, "<g fill") + 1, '<') : "/>";
            assert_in_range(line, 1, 150);
            int n = snprintf(look[k], sizeof look[k], "%.*s ", line, at);
            for (; *marker != '/'; marker++) /* without its numbers */
                if (isalpha((unsigned char)*marker) && n < 199) look[k][n++] = *marker;
            look[k][n] = 0;
            for (int other = 0; other < k; other++) assert_string_not_equal(look[k], look[other]);
        }
        free(text);
    }
}

/* The white box of the legend, or false if it stands outside. */
static bool legend_box(const char *text, double box[4]) {
    const char *at = strstr(text, "rx=\"4\"");
    if (!at) return false;
    while (at > text && *at != '<') at--;
    return sscanf(at, "<rect x=\"%lf\" y=\"%lf\" width=\"%lf\" height=\"%lf\"", &box[0], &box[1], &box[2], &box[3]) ==
           4;
}

static void test_legend_keeps_off_the_data(void **state) {
    (void)state;
    enum { N = 200 };
    double x[N], y[N], area[4], box[4];
    int inside = 0;
    for (int shape = 0; shape < 40; shape++) {
        for (int i = 0; i < N; i++) {
            x[i] = i / (N - 1.0);
            double s = x[i], a = 1.0 + shape % 8;
            y[i] = shape < 8    ? pow(s, a)
                   : shape < 16 ? 1.0 - pow(s, 1.0 / a)
                   : shape < 24 ? sin(a * s)
                   : shape < 32 ? s * (1.0 - s) * a
                                : cos(a * 3.0 * s);
        }
        riddle_plot *p = riddle_plot_new(NULL, 1, 1);
        riddle_plot_panel(p, 0, 0, "x [-]", "y [-]");
        riddle_plot_range_x(p, 0.0, 1.0);
        riddle_plot_range_y(p, -1.2, 1.2);
        riddle_plot_line(p, "a series with a name", x, y, N);
        riddle_plot_line(p, "another", x, y, N);
        char *text = drawn(p);
        frame(text, area);
        if (legend_box(text, box)) {
            inside++;
            assert_true(box[0] >= area[0] && box[1] >= area[1] && box[0] + box[2] <= area[0] + area[2] &&
                        box[1] + box[3] <= area[1] + area[3]);
            for (int i = 0; i < N; i++) {
                double px = area[0] + area[2] * x[i], py = area[1] + area[3] * (1.2 - y[i]) / 2.4;
                assert_false(px > box[0] && px < box[0] + box[2] && py > box[1] && py < box[1] + box[3]);
            }
        }
        free(text);
    }
    assert_true(inside >= 30);
}

static double text_x(const char *svg, const char *label) {
    const char *end = strstr(svg, label);
    assert_non_null(end);
    const char *start = end;
    while (strncmp(start, "<text", 5) != 0) start--;
    return strtod(strstr(start, "x=\"") + 3, NULL);
}

/* A text that would leave its panel at the right is moved to the left, one that fits is not. */
static void test_text_stays_in_its_panel(void **state) {
    (void)state;
    const double x[2] = {0, 1};
    riddle_plot *p = riddle_plot_new("texts", 1, 1);
    riddle_plot_panel(p, 0, 0, "x", "y");
    riddle_plot_line(p, NULL, x, x, 2);
    riddle_plot_text_share(p, 0.0, 0.5, "begin");
    riddle_plot_text_share(p, 0.5, 0.5, "middle");
    riddle_plot_text_share(p, 1.0, 0.4, "I");
    riddle_plot_text_share(p, 0.9, 0.6, "a text of forty letters, which is long ..");
    riddle_plot_text(p, 0.95, 0.2, "a text of forty letters, at a place here");
    char *svg = drawn(p);
    const double begin = text_x(svg, ">begin<"), middle = text_x(svg, ">middle<"), end = text_x(svg, ">I<");
    assert_true(end > middle && 2.0 * (middle - begin) > end - begin && 2.0 * (middle - begin) < end - begin + 30.0);
    const double one = text_x(svg, ">a text of forty letters, which"),
                 two = text_x(svg, ">a text of forty letters, at");
    assert_true(one > begin && one + 40.0 * 14.0 * 0.35 < end);
    assert_true(two > begin && two + 40.0 * 14.0 * 0.35 < end);
    free(svg);
}

/* To scale: a disc of radius 1 on an axis of 4 is a quarter of the frame wide. */
static void test_discs_are_to_scale(void **state) {
    (void)state;
    double x[] = {0.0, 1.0}, y[] = {0.0, 0.5}, r[] = {1.0, 0.25}, box[4];
    riddle_plot *p = riddle_plot_new(NULL, 1, 1);
    riddle_plot_panel_size(p, 400.0, 400.0);
    riddle_plot_panel(p, 0, 0, "x [m]", "y [m]");
    riddle_plot_range_x(p, -2.0, 2.0);
    riddle_plot_range_y(p, -2.0, 2.0);
    riddle_plot_discs(p, NULL, x, y, r, 2);
    char *text = drawn(p);
    expect_well_formed(text);
    frame(text, box);
    const char *at = text;
    for (int i = 0; i < 2; i++) {
        double cx, cy, radius;
        at = strstr(at + 1, "<circle");
        assert_non_null(at);
        assert_int_equal(sscanf(at, "<circle cx=\"%lf\" cy=\"%lf\" r=\"%lf\"", &cx, &cy, &radius), 3);
        assert_true(fabs(cx - box[0] - box[2] * (x[i] + 2.0) / 4.0) < 0.1 &&
                    fabs(cy - box[1] - box[3] * (2.0 - y[i]) / 4.0) < 0.1);
        assert_true(fabs(radius - 100.0 * r[i]) < 0.1);
    }
    free(text);
}

static void test_same_input_same_picture(void **state) {
    (void)state;
    double x[] = {0.0, 1.0, 2.0}, y[] = {0.3, 0.1, 0.2};
    char *texts[2];
    for (int i = 0; i < 2; i++) {
        riddle_plot *p = riddle_plot_new("t", 2, 2);
        riddle_plot_panel(p, 1, 1, "x", "y");
        riddle_plot_line(p, "a", x, y, 3);
        texts[i] = drawn(p);
    }
    assert_string_equal(texts[0], texts[1]);
    free(texts[0]);
    free(texts[1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_data_stand_on_the_axes),
        cmocka_unit_test(test_log_axes),
        cmocka_unit_test(test_small_numbers_share_an_exponent),
        cmocka_unit_test(test_hostile_data),
        cmocka_unit_test(test_scale_bar),
        cmocka_unit_test(test_wrong_calls),
        cmocka_unit_test(test_classes_and_long_labels),
        cmocka_unit_test(test_many_lines_differ),
        cmocka_unit_test(test_legend_keeps_off_the_data),
        cmocka_unit_test(test_text_stays_in_its_panel),
        cmocka_unit_test(test_discs_are_to_scale),
        cmocka_unit_test(test_same_input_same_picture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
