/* riddle_io.h on its own, as a host includes it: files are whole or absent, missing folders are made, and running out
   of memory anywhere leaves nothing behind. What stands in the files is read back in test_common.c and test_plot.c. */
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <dirent.h>
#include <locale.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static long allowed = -1; /* how many more blocks there are; -1: any number */
static int blocks;        /* held now */
static int said, created_files;
static char last_line[1000];

static void *resize(void *old, size_t size) {
    if (allowed == 0) return NULL;
    if (allowed > 0) allowed--;
    void *memory = realloc(old, size);
    if (!old && memory) blocks++;
    return memory;
}

static void give_back(void *old) {
    blocks--;
    free(old);
}

static void told(const char *line) {
    said++;
    snprintf(last_line, sizeof last_line, "%s", line);
}

#define RIDDLE_IO_REALLOC(old, size) resize(old, size)
#define RIDDLE_IO_FREE(old) give_back(old)
#define RIDDLE_IO_FAIL(line) told(line)
#define RIDDLE_IO_CREATED(name) (created_files += *(name) != 0)
#define RIDDLE_IO_GONE(name) (created_files -= *(name) != 0)
#include "riddle_io.h"
#include "riddle_plot.h"

static char folder[200];

static int begin(void **state) {
    (void)state;
    const char *base = getenv("TMPDIR");
    allowed = -1;
    blocks = said = created_files = 0;
    snprintf(folder, sizeof folder, "%s/riddle-io.XXXXXX", base ? base : "/tmp");
    return mkdtemp(folder) ? 0 : -1;
}

/* Counts the files below a folder, and removes all of it when asked. */
static int files_below(const char *path, bool clear) {
    int n = 0;
    DIR *d = opendir(path);
    for (struct dirent *e; d && (e = readdir(d)) != NULL;) {
        char inner[700];
        if (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0) continue;
        snprintf(inner, sizeof inner, "%s/%s", path, e->d_name);
        struct stat info;
        if (lstat(inner, &info) == 0 && S_ISDIR(info.st_mode)) n += files_below(inner, clear);
        else {
            n++;
            if (clear) remove(inner);
        }
    }
    if (d) closedir(d);
    if (clear) rmdir(path);
    return n;
}

static int end(void **state) {
    (void)state;
    files_below(folder, true);
    return blocks || created_files ? -1 : 0; /* nothing is kept */
}

static void expect_text(const char *path, const char *expected) {
    char text[500] = "";
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    text[fread(text, 1, sizeof text - 1, f)] = '\0';
    fclose(f);
    assert_string_equal(text, expected);
}

static void test_missing_folders_are_made(void **state) {
    (void)state;
    char inner[400], path[500];
    const double row[] = {1.5, (double)NAN, -HUGE_VAL, 1e-300};
    riddle_io_path(inner, sizeof inner, folder, "a/b//c");
    riddle_io_file *f = riddle_io_open(inner, "d/table.csv");
    assert_non_null(f);
    assert_int_equal(riddle_io_print(f, "x,y,z,w\n"), RIDDLE_IO_OK);
    assert_int_equal(riddle_io_row(f, row, 4), RIDDLE_IO_OK);
    assert_int_equal(riddle_io_row(f, NULL, 0), RIDDLE_IO_OK);
    const double shortest[] = {0.06, 0.1, 1.0 / 3.0, 0.1 + 0.2, 12345678.0, 5e-324, 1.7976931348623157e308, -0.0};
    assert_int_equal(riddle_io_row(f, shortest, 8), RIDDLE_IO_OK);
    riddle_io_path(path, sizeof path, inner, "d/table.csv");
    assert_int_equal(access(path, F_OK), -1); /* not there before it is whole */
    assert_int_equal(created_files, 1);
    assert_int_equal(riddle_io_close(f), RIDDLE_IO_OK);
    expect_text(
        path,
        "x,y,z,w\n1.5,,,1e-300\n\n"
        "0.06,0.1,0.3333333333333333,0.30000000000000004,12345678,4.94065645841247e-324,1.7976931348623157e+308,-0\n");
    assert_int_equal(files_below(folder, false), 1);
}

static void test_the_older_file_stays(void **state) {
    (void)state;
    char path[400];
    riddle_io_file *f = riddle_io_open(folder, "a");
    riddle_io_print(f, "old");
    assert_int_equal(riddle_io_close(f), RIDDLE_IO_OK);
    f = riddle_io_open(folder, "a");
    riddle_io_print(f, "new");
    riddle_io_discard(f);
    expect_text(riddle_io_path(path, sizeof path, folder, "a"), "old");
    assert_int_equal(files_below(folder, false), 1);
}

static void test_refused(void **state) {
    (void)state;
    char path[400], message[100] = "";
    assert_null(riddle_io_open(NULL, NULL));
    assert_null(riddle_io_open(folder, ".."));
    riddle_io_close(riddle_io_open(folder, "file"));
    assert_null(riddle_io_open(riddle_io_path(path, sizeof path, folder, "file/sub"), "x"));
    assert_non_null(strstr(last_line, "/file/sub/x: Not a directory"));
    assert_int_equal(riddle_io_make_folder(path, message, sizeof message), RIDDLE_IO_NOT_WRITTEN);
    assert_string_equal(message, "Not a directory");
    assert_int_equal(riddle_io_make_folder("", message, sizeof message), RIDDLE_IO_BAD_ARGUMENT);
    assert_int_equal(riddle_io_make_folder(NULL, NULL, 0), RIDDLE_IO_BAD_ARGUMENT);
    assert_int_equal(riddle_io_can_write(NULL, NULL, 0), RIDDLE_IO_BAD_ARGUMENT);
    assert_int_equal(riddle_io_can_write(folder, message, sizeof message), RIDDLE_IO_NOT_WRITTEN);
    assert_int_equal(riddle_io_write(NULL, "x", 1), RIDDLE_IO_BAD_ARGUMENT);
    assert_int_equal(riddle_io_print(NULL, "x"), RIDDLE_IO_BAD_ARGUMENT);
    assert_int_equal(riddle_io_row(NULL, NULL, 0), RIDDLE_IO_BAD_ARGUMENT);
    assert_int_equal(riddle_io_close(NULL), RIDDLE_IO_BAD_ARGUMENT);
    riddle_io_discard(NULL);
    assert_null(riddle_io_series_open(folder, NULL));
    assert_null(riddle_io_series_name(NULL, 0.0));
    assert_int_equal(riddle_io_series_close(NULL), RIDDLE_IO_BAD_ARGUMENT);
    riddle_io_array nothing = riddle_io_scalar("x", NULL);
    assert_int_equal(riddle_io_points(folder, "p.vtp", 1, nothing, NULL, 0), RIDDLE_IO_BAD_ARGUMENT);
    assert_int_equal(riddle_io_points(folder, "p.vtp", -1, riddle_io_vector("position", NULL), NULL, 0),
                     RIDDLE_IO_BAD_ARGUMENT);
    assert_int_equal(riddle_io_points(folder, "p.vtp", 0, riddle_io_vector("position", NULL), NULL, 0), RIDDLE_IO_OK);
    assert_int_equal(riddle_io_lines(folder, "l.vtp", 0, riddle_io_vector("position", NULL), 1, NULL, NULL, NULL, 0),
                     RIDDLE_IO_BAD_ARGUMENT);
    const double square[12] = {0.0};
    const int falling[] = {3, 2}, corners[] = {0, 1, 4}, triangle[] = {3};
    assert_int_equal(
        riddle_io_polygons(folder, "l.vtp", 4, riddle_io_vector("position", square), 2, falling, corners, NULL, 0),
        RIDDLE_IO_BAD_ARGUMENT);
    assert_int_equal(
        riddle_io_polygons(folder, "l.vtp", 4, riddle_io_vector("position", square), 1, triangle, corners, NULL, 0),
        RIDDLE_IO_BAD_ARGUMENT);
    const int none[3] = {0, 1, 1};
    const double place[3] = {0.0, 0.0, 0.0};
    assert_int_equal(riddle_io_cells(folder, "c.vti", none, place, place, NULL, 0), RIDDLE_IO_BAD_ARGUMENT);
    riddle_io_table t = riddle_io_table_begin("a|b");
    riddle_io_table_end(&t, NULL);
    assert_int_equal(files_below(folder, false), 2);
    for (int i = 0; i <= RIDDLE_IO_STATUS_COUNT + 1; i++)
        assert_true(strlen(riddle_io_status_text((riddle_io_status)i)) > 0);
}

/* In a folder that one may not write to, the line has the reason why its subfolder could not be made. */
static void test_the_reason_is_that_of_the_folder(void **state) {
    (void)state;
    char path[400];
    const bool root = geteuid() == 0;
    assert_int_equal(chmod(folder, 0555), 0);
    if (root && seteuid(65534) != 0) skip();
    riddle_io_file *file = riddle_io_open(riddle_io_path(path, sizeof path, folder, "sub/below"), "x");
    if (root) assert_int_equal(seteuid(0), 0);
    assert_int_equal(chmod(folder, 0755), 0);
    assert_null(file);
    assert_non_null(strstr(last_line, "/sub/below/x: Permission denied"));
}

static void test_a_full_disk_is_told(void **state) {
    (void)state;
    if (access("/dev/full", W_OK) != 0) skip();
    const double xyz[] = {1.0, 2.0, 3.0};
    assert_int_equal(riddle_io_points(NULL, "/dev/full", 1, riddle_io_vector("position", xyz), NULL, 0),
                     RIDDLE_IO_NOT_WRITTEN);
    assert_string_equal(last_line, "/dev/full: No space left on device");
    assert_int_equal(riddle_plot_write(riddle_plot_new(NULL, 1, 1), NULL, "/dev/full"), RIDDLE_IO_NOT_WRITTEN);
    assert_int_equal(said, 2);
}

/* Everything that takes memory. True if every step told that it worked. */
static bool write_everything(void) {
    const double x[] = {0.0, 1.0, 2.0}, xyz[9] = {0.0};
    static const char *const names[] = {"a", "b", "c"};
    const int ends[] = {3}, corners[] = {0, 1, 2}, size[3] = {3, 1, 1};
    bool worked = true;
    riddle_io_array array = riddle_io_scalar("x", x), position = riddle_io_vector("position", xyz);
    riddle_io_series *series = riddle_io_series_open(folder, "s.pvd");
    for (int i = 0; i < 3; i++)
        worked &= riddle_io_points(folder, riddle_io_series_name(series, i), 3, position, &array, 1) == RIDDLE_IO_OK;
    worked &= riddle_io_series_close(series) == RIDDLE_IO_OK;
    worked &= riddle_io_polygons(folder, "t.vtp", 3, position, 1, ends, corners, NULL, 0) == RIDDLE_IO_OK;
    worked &= riddle_io_cells(folder, "c.vti", size, x, x, &array, 1) == RIDDLE_IO_OK;
    riddle_plot *p = riddle_plot_new("title", 1, 2);
    riddle_plot_panel(p, 0, 0, "x", "y");
    riddle_plot_title(p, "panel");
    riddle_plot_line(p, "line", x, x, 3);
    riddle_plot_band(p, "band", x, x, x, 3);
    riddle_plot_error_bars(p, "error", x, x, x, 3);
    riddle_plot_horizontal(p, "h", 1.0);
    for (int i = 0; i < 20; i++) riddle_plot_text(p, 0.0, 0.0, "text");
    riddle_plot_panel(p, 0, 1, "x", "y");
    riddle_plot_bars(p, "bars", names, x, 3);
    riddle_plot_heat(p, "heat", x, 3, 1, 0.0, 1.0, 0.0, 1.0);
    riddle_plot_heat_range(p, 0.0, 1.0);
    worked &= riddle_plot_write(p, folder, "p.svg") == RIDDLE_IO_OK;
    char message[100];
    worked &= riddle_io_make_folder(folder, message, sizeof message) == RIDDLE_IO_OK;
    int before = said;
    riddle_io_table t = riddle_io_table_begin("a|b");
    riddle_io_table_cell(&t, "%300d", 1);
    riddle_io_table_end(&t, NULL);
    return worked && said == before;
}

static void test_every_block_may_be_missing(void **state) {
    (void)state;
    int failures = 0;
    for (long n = 0;; n++) {
        allowed = n;
        said = 0;
        bool worked = write_everything();
        assert_int_equal(blocks, 0);
        assert_int_equal(created_files, 0);
        if (worked) break;
        failures++;
        assert_true(n < 1000);
    }
    assert_true(failures > 50);
    /* Three frames and their index, polygons, cells, figure; no temporary ones. */
    assert_int_equal(files_below(folder, false), 7);
}

static riddle_io_status write_point(const char *where, const char *name) {
    const double xyz[] = {1.0, 2.0, 3.0};
    return riddle_io_points(where, name, 1, riddle_io_vector("position", xyz), NULL, 0);
}

/* The frames of the index at `path`, with a blank after each: "s_0000.vtp s_0001.vtp ". */
static const char *listed(const char *path) {
    static char text[6000], names[3000];
    FILE *f = fopen(path, "rb");
    assert_non_null(f);
    text[fread(text, 1, sizeof text - 1, f)] = '\0';
    fclose(f);
    names[0] = '\0';
    for (char *at = text; (at = strstr(at, " file=\"")) != NULL;) {
        at += strlen(" file=\"");
        strncat(names, at, strcspn(at, "\""));
        strcat(names, " ");
    }
    return names;
}

/* Readers look for a frame beside the index, also where the name of the series has a folder, or is a whole path. */
static void test_a_series_name_with_a_folder(void **state) {
    (void)state;
    char path[400], whole[300];
    riddle_io_path(whole, sizeof whole, folder, "run2/grains.pvd");
    for (int kind = 0; kind < 2; kind++) {
        const char *where = kind ? NULL : folder;
        riddle_io_series *series = riddle_io_series_open(where, kind ? whole : "run1/grains");
        assert_non_null(series);
        for (int k = 0; k < 2; k++)
            assert_int_equal(write_point(where, riddle_io_series_name(series, k)), RIDDLE_IO_OK);
        assert_int_equal(riddle_io_series_close(series), RIDDLE_IO_OK);
        riddle_io_path(path, sizeof path, folder, kind ? "run2/grains.pvd" : "run1/grains.pvd");
        assert_string_equal(listed(path), "grains_0000.vtp grains_0001.vtp ");
        assert_int_equal(files_below(folder, false), 3 * (kind + 1));
    }
}

/* No name is cut: what does not fit is refused, with a line that tells why. */
static void test_long_names(void **state) {
    (void)state;
    char name[1200], path[1500];
    memset(name, 'd', sizeof name);
    for (int i = 100; i < 1150; i += 100) name[i] = '/';
    name[450] = '\0';
    riddle_io_series *series = riddle_io_series_open(folder, name);
    for (int k = 0; k < 2; k++) assert_int_equal(write_point(folder, riddle_io_series_name(series, k)), RIDDLE_IO_OK);
    assert_null(riddle_io_series_name_as(series, 2.0, "extended"));
    assert_null(riddle_io_series_name_as(series, 2.0, ""));
    assert_int_equal(said, 2);
    const char *longest = riddle_io_series_name_as(series, 2.0, "extende");
    assert_non_null(longest);
    assert_string_equal(longest + 450, "_0002.extende");
    assert_int_equal(riddle_io_series_close(series), RIDDLE_IO_OK);
    assert_int_equal(files_below(folder, false), 3);
    snprintf(path, sizeof path, "%s/%s.pvd", folder, name);
    assert_non_null(strstr(listed(path), "d_0000.vtp "));
    assert_non_null(strstr(listed(path), "d_0001.vtp "));
    name[450] = 'd';
    name[RIDDLE_IO_SERIES_BYTES + 1] = '\0';
    assert_null(riddle_io_series_open(folder, name));
    assert_non_null(strstr(last_line, "at most 1000 bytes"));
    name[RIDDLE_IO_SERIES_BYTES] = '\0';
    series = riddle_io_series_open(folder, name);
    assert_non_null(series);
    longest = riddle_io_series_name(series, 0.0);
    assert_non_null(longest);
    assert_string_equal(longest + RIDDLE_IO_SERIES_BYTES, "_0000.vtp");
    assert_int_equal(riddle_io_series_close(series), RIDDLE_IO_OK);
    riddle_io_path(path, sizeof path, folder, "file");
    riddle_io_close(riddle_io_open(NULL, path));
    snprintf(path, sizeof path, "%s/file/%s", folder, name);
    assert_null(riddle_io_open(NULL, path)); /* the line has room for the reason */
    assert_non_null(strstr(last_line, "d: Not a directory"));
    assert_string_equal(riddle_io_path(path, strlen(folder) + 6, folder, "name") + strlen(folder), "/name");
    assert_string_equal(riddle_io_path(path, strlen(folder) + 6, folder, "names"), "");
}

/* The index lists what is there: no frame that failed, and no older file in its place. */
static void test_frames_that_are_not_there(void **state) {
    (void)state;
    char index[300], late[100], path[300];
    riddle_io_path(index, sizeof index, folder, "s.pvd");
    assert_int_equal(mkdir(riddle_io_path(path, sizeof path, folder, "s_0001.vtp"), 0777), 0);
    assert_int_equal(write_point(folder, "s_0003.vtp"), RIDDLE_IO_OK); /* of a run before */
    riddle_io_series *series = riddle_io_series_open(folder, "s");
    assert_non_null(series);
    riddle_io_series_drop(series); /* nothing is named yet */
    assert_int_equal(write_point(folder, riddle_io_series_name(series, 0.0)), RIDDLE_IO_OK);
    assert_int_equal(write_point(folder, riddle_io_series_name(series, 1.0)), RIDDLE_IO_NOT_WRITTEN);
    snprintf(late, sizeof late, "%s", riddle_io_series_name(series, 2.0));
    assert_string_equal(listed(index), "s_0000.vtp ");
    assert_non_null(riddle_io_series_name(series, 3.0));
    riddle_io_series_drop(series);
    assert_int_equal(write_point(folder, riddle_io_series_name(series, 4.0)), RIDDLE_IO_OK);
    assert_int_equal(write_point(folder, late), RIDDLE_IO_OK);
    assert_null(riddle_io_series_name_as(series, 5.0, "too long"));
    riddle_io_series_drop(series); /* no frame was named */
    assert_int_equal(riddle_io_series_close(series), RIDDLE_IO_OK);
    assert_string_equal(listed(index), "s_0000.vtp s_0002.vtp s_0004.vtp ");
    riddle_io_series_drop(NULL);
}

/* Prints by riddle_io__print, and says what vsnprintf makes of it. */
static void print_both(FILE *stream, char *expected, size_t size, const char *format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    vsnprintf(expected, size, format, again);
    va_end(again);
    assert_true(riddle_io__print(stream, format, &arguments));
    va_end(arguments);
}

static bool printed(FILE *stream, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    const bool worked = riddle_io__print(stream, format, &arguments);
    va_end(arguments);
    return worked;
}

/* What is printed where the locale has a decimal comma: every kind of conversion, as the C library prints it. */
static void test_conversions(void **state) {
    (void)state;
    char path[300], expected[1500];
    riddle_io_path(path, sizeof path, folder, "printed");
#define PRINTED(...)                                                                                                   \
    do {                                                                                                               \
        FILE *f = fopen(path, "wb");                                                                                   \
        assert_non_null(f);                                                                                            \
        print_both(f, expected, sizeof expected, __VA_ARGS__);                                                         \
        fclose(f);                                                                                                     \
        expect_text(path, expected);                                                                                   \
    } while (0)
    PRINTED("%s", "");
    PRINTED("no conversion");
    PRINTED("100 %%, %d of %d; %5.1f %%|", 3, -4, 99.5);
    PRINTED("%-*.*f|%*d|%.*s|%-8s|%c", 9, 3, 1.5, 4, 7, 2, "abcdef", "x", 'y');
    PRINTED("%.17g,%g,%e,%G,%a,%f", 0.1, 1e-300, -2.5e10, 1e300, 0.75, -1e308);
    PRINTED("%g %g %g", (double)NAN, HUGE_VAL, -HUGE_VAL);
    PRINTED("%ld %lu %lld %llu %zu %#x %+i %05u %o %hd", -5L, 6UL, -7LL, 8ULL, (size_t)9, 255U, 3, 42U, 8U,
            (int)(short)11);
    PRINTED("%jd %td %p", (intmax_t)-12, (ptrdiff_t)13, (void *)path);
    PRINTED("a%sb%sc", "%d", "100 %");
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_false(printed(f, "%.450f", 0.1)); /* a number that does not fit is not cut */
    fclose(f);
}

/* A host's locale with a decimal comma changes no file. */
static void test_a_decimal_comma(void **state) {
    (void)state;
    char command[700], path[400], text[60000];
    const char *const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "comma"};
    const char *found = NULL;
    snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 '%s/comma' >/dev/null 2>&1", folder);
    for (int k = 0; k < 4 && !found; k++) {
        if (k == 3 && (setenv("LOCPATH", folder, 1) != 0 || system(command) != 0)) break;
        found = setlocale(LC_NUMERIC, names[k]);
    }
    if (!found || strcmp(localeconv()->decimal_point, ",") != 0) {
        setlocale(LC_NUMERIC, "C");
        skip(); /* no such locale here, and no localedef */
    }
    const double row[] = {1.5, -2.25e-7}, x[] = {0.0, 0.25, 0.5}, y[] = {0.001, 0.0125, 0.02}, xyz[] = {0.0, 0.5, 1.0};
    riddle_io_file *f = riddle_io_open(folder, "row.csv");
    riddle_io_row(f, row, 2);
    riddle_io_print(f, "%.2f;%s,%d\n", 0.125, "a,b", 3);
    assert_int_equal(riddle_io_close(f), RIDDLE_IO_OK);
    riddle_plot *figure = riddle_plot_new("numbers", 1, 2);
    riddle_plot_panel(figure, 0, 0, "x", "y");
    riddle_plot_line(figure, "line", x, y, 3);
    riddle_plot_panel(figure, 0, 1, "x", "y");
    riddle_plot_log_y(figure);
    riddle_plot_points(figure, NULL, x, y, 3);
    assert_int_equal(riddle_plot_write(figure, folder, "plot.svg"), RIDDLE_IO_OK);
    riddle_io_series *series = riddle_io_series_open(folder, "s");
    riddle_io_points(folder, riddle_io_series_name(series, 0.125), 1, riddle_io_vector("position", xyz), NULL, 0);
    riddle_io_series_close(series);
    setlocale(LC_NUMERIC, "C");
    expect_text(riddle_io_path(path, sizeof path, folder, "row.csv"), "1.5,-2.25e-07\n0.12;a,b,3\n");
    const char *const files[] = {"plot.svg", "s.pvd"};
    for (int k = 0; k < 2; k++) {
        FILE *read = fopen(riddle_io_path(path, sizeof path, folder, files[k]), "rb");
        assert_non_null(read);
        text[fread(text, 1, sizeof text - 1, read)] = '\0';
        fclose(read);
        assert_non_null(strstr(text, k ? "timestep=\"0.125\"" : ">0.2<"));
        /* Only pairs of coordinates and lists of faces have commas. */
        for (char *c = strchr(text, ','); c; c = strchr(c + 1, ','))
            assert_false(c[-1] >= '0' && c[-1] <= '9' && c[1] >= '0' && c[1] <= '9' && k);
        assert_null(strstr(text, ">0,2<"));
    }
}

static void test_progress(void **state) {
    (void)state;
    riddle_io_progress bar;
    riddle_io_progress_begin(&bar, "nothing", (double)NAN);
    bar.active = 0;
    riddle_io_progress_update(&bar, 1.0);
    riddle_io_progress_end(&bar, NULL);
    assert_true(riddle_io_seconds() > 0.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_missing_folders_are_made, begin, end),
        cmocka_unit_test_setup_teardown(test_the_older_file_stays, begin, end),
        cmocka_unit_test_setup_teardown(test_refused, begin, end),
        cmocka_unit_test_setup_teardown(test_the_reason_is_that_of_the_folder, begin, end),
        cmocka_unit_test_setup_teardown(test_a_full_disk_is_told, begin, end),
        cmocka_unit_test_setup_teardown(test_every_block_may_be_missing, begin, end),
        cmocka_unit_test_setup_teardown(test_a_series_name_with_a_folder, begin, end),
        cmocka_unit_test_setup_teardown(test_long_names, begin, end),
        cmocka_unit_test_setup_teardown(test_frames_that_are_not_there, begin, end),
        cmocka_unit_test_setup_teardown(test_conversions, begin, end),
        cmocka_unit_test_setup_teardown(test_a_decimal_comma, begin, end),
        cmocka_unit_test(test_progress),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
