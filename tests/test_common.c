/* examples/common: command line, files that are whole or absent, JSON, CSV, tables, ParaView files, jobs. */
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <dirent.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common.h"
#include "steady.h"

static char folder[200]; /* made new for each test */

static int make_folder(void **state) {
    (void)state;
    const char *base = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/riddle-test.XXXXXX", base ? base : "/tmp");
    return mkdtemp(folder) ? 0 : -1;
}

static int files_in(const char *path) {
    int n = 0;
    DIR *d = opendir(path);
    for (struct dirent *e; d && (e = readdir(d)) != NULL;)
        n += strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0;
    if (d) closedir(d);
    return d ? n : -1;
}

static int remove_folder(void **state) {
    (void)state;
    DIR *d = opendir(folder);
    char path[600];
    for (struct dirent *e; d && (e = readdir(d)) != NULL;) {
        snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
        if (strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0) remove(path);
    }
    if (d) closedir(d);
    return rmdir(folder);
}

/* The file as text with a 0 at the end; the caller frees it. */
static char *slurp(const char *name, long *size) {
    char path[600];
    FILE *f = fopen(riddle_io_path(path, sizeof path, folder, name), "rb");
    if (!f) return NULL;
    fseek(f, 0, SEEK_END);
    long n = ftell(f);
    rewind(f);
    char *text = malloc((size_t)n + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, (size_t)n, f), n);
    text[n] = '\0';
    fclose(f);
    if (size) *size = n;
    return text;
}

static void expect_file(const char *name, const char *expected) {
    char *text = slurp(name, NULL);
    assert_non_null(text);
    assert_string_equal(text, expected);
    free(text);
}

/* ---- command line ---- */

typedef struct {
    int run, law;
    double time, angle;
    bool flag;
    const char *text;
    uint64_t seed2;
    option options[7];
    program self;
    char message[300];
} line;

static int parse(line *l, const char *arguments) {
    static char storage[1000];
    char *argv[40] = {"prog"};
    int argc = 1;
    l->run = 5;
    l->law = 0;
    l->time = 5.0;
    l->angle = -10.0;
    l->flag = false;
    l->text = NULL;
    l->seed2 = 7;
    option options[7] = {
        option_int("case", "N", &l->run, 1, 15, "case"),
        option_positive("time", "S", &l->time, 1e4, "time [s]"),
        option_double("angle", "DEG", &l->angle, -90.0, 90.0, "angle [deg]"),
        option_flag("wet", &l->flag, "with liquid"),
        option_choice("law", &l->law, "linear|hertz|jkr", "contact law"),
        option_string("input", "FILE", &l->text, "file"),
        option_seed("other-seed", "N", &l->seed2, "seed"),
    };
    memcpy(l->options, options, sizeof options);
    program self = {"prog", "out/prog", NULL, 2, 1, false, false, false, 0.0, NULL, 0};
    l->self = self;
    l->message[0] = '\0';
    snprintf(storage, sizeof storage, "%s", arguments);
    for (char *word = strtok(storage, " "); word && argc < 39; word = strtok(NULL, " ")) argv[argc++] = word;
    return options_parse(&l->self, l->options, 7, argc, argv, l->message, (int)sizeof l->message);
}

static void test_options_good(void **state) {
    (void)state;
    line l;
    assert_int_equal(parse(&l, ""), 0);
    assert_true(l.run == 5 && l.time == 5.0 && l.angle == -10.0 && !l.flag && l.law == 0 && !l.text &&
                l.self.seed == 1);
    assert_int_equal(
        parse(
            &l,
            "--case 15 --time=0.25 --angle -1e1 --wet --law hertz --input a=b --seed 18446744073709551615 --threads 3"),
        0);
    assert_true(l.run == 15 && l.time == 0.25 && l.angle == -10.0 && l.flag && l.law == 1 && l.self.threads == 3);
    assert_string_equal(l.text, "a=b");
    assert_true(l.self.seed == UINT64_MAX && l.options[0].given && l.options[2].given && !l.options[6].given);
    assert_int_equal(parse(&l, "--out x/y --json - --quick --quiet --law=jkr --input=--odd --time .5"), 0);
    assert_true(l.self.quick && l.self.quiet && l.law == 2 && l.time == 0.5);
    assert_string_equal(l.self.out, "x/y");
    assert_string_equal(l.self.json, "-");
    assert_string_equal(l.text, "--odd");
    assert_int_equal(parse(&l, "--case 3 --case 4"), 0);
    assert_int_equal(l.run, 4); /* the last one counts */
    assert_int_equal(parse(&l, "--case 3 --help"), 1);
    assert_int_equal(parse(&l, "-h"), 1);
}

static void test_option_of_a_size(void **state) {
    (void)state;
    int size[2] = {960, 640};
    char message[300];
    program self = {"prog", "out/prog", NULL, 2, 1, false, false, false, 0.0, NULL, 0};
    static const char *const bad[] = {"1920",    "1920x",   "x1280", "63x640", "640x63",
                                      "4097x64", "64x4097", "64X64", "64x64x", "64x64.0",
                                      "64x-64",  "+64x64",  "64x",   "",       "99999999999999999999x64",
                                      "64x 64"};
    option o = option_size("size", size, "of the picture");
    char *argv[] = {(char *)"prog", (char *)"--size", (char *)"1920x1280"};
    assert_int_equal(options_parse(&self, &o, 1, 3, argv, message, (int)sizeof message), 0);
    assert_true(size[0] == 1920 && size[1] == 1280 && o.given);
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        argv[2] = (char *)bad[k];
        if (options_parse(&self, &o, 1, 3, argv, message, (int)sizeof message) != 2) fail_msg("'%s' was taken", bad[k]);
        assert_non_null(strstr(message, "allowed: width x height, such as 1920x1280, each from 64 to 4096"));
        assert_true(size[0] == 1920 && size[1] == 1280);
    }
}

static void test_options_bad(void **state) {
    (void)state;
    static const char *const bad[][2] = {
        {"--case 0", "prog: --case 0: allowed: a whole number from 1 to 15"},
        {"--case 16", "prog: --case 16: allowed: a whole number from 1 to 15"},
        {"--case 5.0", "prog: --case 5.0: allowed: a whole number from 1 to 15"},
        {"--case 5x", "prog: --case 5x: allowed: a whole number from 1 to 15"},
        {"--case=", "prog: --case : allowed: a whole number from 1 to 15"},
        {"--case", "prog: --case has no value; allowed: a whole number from 1 to 15"},
        {"--case --wet", "prog: --case has no value; allowed: a whole number from 1 to 15"},
        {"--case 99999999999999999999999",
         "prog: --case 99999999999999999999999: allowed: a whole number from 1 to 15"},
        {"--time nan", "prog: --time nan: allowed: a number above 0 and at most 10000"},
        {"--time NAN(1)", "prog: --time NAN(1): allowed: a number above 0 and at most 10000"},
        {"--time inf", "prog: --time inf: allowed: a number above 0 and at most 10000"},
        {"--time -1", "prog: --time -1: allowed: a number above 0 and at most 10000"},
        {"--time 0", "prog: --time 0: allowed: a number above 0 and at most 10000"},
        {"--time 1e999", "prog: --time 1e999: allowed: a number above 0 and at most 10000"},
        {"--time 0x10", "prog: --time 0x10: allowed: a number above 0 and at most 10000"},
        {"--time 1,5", "prog: --time 1,5: allowed: a number above 0 and at most 10000"},
        {"--time 1e", "prog: --time 1e: allowed: a number above 0 and at most 10000"},
        {"--time --", "prog: --time has no value; allowed: a number above 0 and at most 10000"},
        {"--angle 90.001", "prog: --angle 90.001: allowed: a number from -90 to 90"},
        {"--wet=1", "prog: --wet 1: takes no value"},
        {"--law herz", "prog: --law herz: allowed: one of linear|hertz|jkr"},
        {"--law linear|hertz", "prog: --law linear|hertz: allowed: one of linear|hertz|jkr"},
        {"--law=", "prog: --law : allowed: one of linear|hertz|jkr"},
        {"--input=", "prog: --input : allowed: a text that is not empty"},
        {"--threads 0", "prog: --threads 0: allowed: a whole number from 1 to 4096"},
        {"--threads 1000000000", "prog: --threads 1000000000: allowed: a whole number from 1 to 4096"},
        {"--seed -1", "prog: --seed -1: allowed: a whole number from 0 to 18446744073709551615"},
        {"--seed 18446744073709551616",
         "prog: --seed 18446744073709551616: allowed: a whole number from 0 to 18446744073709551615"},
        {"--tme 3", "prog: unknown option --tme, did you mean --time?; --help lists all"},
        {"--Time 3", "prog: unknown option --Time, did you mean --time?; --help lists all"},
        {"--thread=3", "prog: unknown option --thread, did you mean --threads?; --help lists all"},
        {"--xylophone", "prog: unknown option --xylophone; --help lists all"},
        {"case", "prog: 'case' is not an option; --help lists them"},
        {"-case 3", "prog: '-case' is not an option; --help lists them"},
        {"--", "prog: '--' is not an option; --help lists them"},
        {"--=3", "prog: unknown option --; --help lists all"},
        {"--case 1\n2", "prog: --case 1?2: allowed: a whole number from 1 to 15"},
    };
    for (int i = 0; i < (int)(sizeof bad / sizeof *bad); i++) {
        line l;
        if (parse(&l, bad[i][0]) != 2) fail_msg("'%s' was taken", bad[i][0]);
        assert_string_equal(l.message, bad[i][1]);
    }
}

/* ---- files ---- */

static void test_output_whole_or_absent(void **state) {
    (void)state;
    riddle_io_file *f = riddle_io_open(folder, "a.txt");
    assert_non_null(f);
    assert_int_equal(riddle_io_print(f, "%d\n", 1), 0);
    char path[300];
    assert_int_equal(access(riddle_io_path(path, sizeof path, folder, "a.txt"), F_OK),
                     -1); /* not there before it is whole */
    assert_int_equal(riddle_io_close(f), 0);
    expect_file("a.txt", "1\n");
    assert_int_equal(files_in(folder), 1);
    f = riddle_io_open(folder, "a.txt");
    riddle_io_print(f, "other\n");
    riddle_io_discard(f);
    expect_file("a.txt", "1\n"); /* the older one stays */
    f = riddle_io_open(folder, "a.txt");
    riddle_io_print(f, "2\n");
    assert_int_equal(riddle_io_close(f), 0);
    expect_file("a.txt", "2\n");
    assert_int_equal(files_in(folder), 1);
    struct stat info;
    mode_t mask = umask(0);
    umask(mask);
    assert_int_equal(stat(path, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0666 & ~mask);
}

static void test_output_through_a_link(void **state) {
    (void)state;
    char target[300], link_name[300];
    riddle_io_close(riddle_io_open(folder, "target"));
    assert_int_equal(symlink(riddle_io_path(target, sizeof target, folder, "target"),
                             riddle_io_path(link_name, sizeof link_name, folder, "link")),
                     0);
    riddle_io_file *f = riddle_io_open(folder, "link");
    riddle_io_print(f, "through\n");
    assert_int_equal(riddle_io_close(f), 0);
    expect_file("target", "through\n");
    struct stat info;
    assert_int_equal(lstat(link_name, &info), 0);
    assert_true(S_ISLNK(info.st_mode));
}

static void test_output_refused(void **state) {
    (void)state;
    char message[200], path[300];
    assert_null(riddle_io_open("/dev/null/at/all", "x"));
    assert_null(riddle_io_open(NULL, folder)); /* a folder */
    assert_int_not_equal(riddle_io_print(NULL, "x"), 0);
    assert_int_not_equal(riddle_io_write(NULL, "x", 1), 0);
    assert_int_not_equal(riddle_io_close(NULL), 0);
    riddle_io_discard(NULL);
    riddle_io_close(riddle_io_open(folder, "file"));
    snprintf(path, sizeof path, "%s/file/sub", folder);
    assert_int_not_equal(riddle_io_make_folder(path, message, sizeof message), 0);
    assert_string_equal(message, "Not a directory");
    snprintf(path, sizeof path, "%s/a//b/c/", folder);
    assert_int_equal(riddle_io_make_folder(path, message, sizeof message), 0);
    assert_int_equal(riddle_io_make_folder(path, message, sizeof message), 0);
    assert_int_equal(files_in(path), 0);
    for (int cut = 4; cut >= 1; cut--) { /* so that the folder can be removed again */
        static const char *const parts[] = {"", "a", "a/b", "a/b/c"};
        snprintf(path, sizeof path, "%s/%s", folder, parts[cut - 1]);
        if (cut > 1) assert_int_equal(rmdir(path), 0);
    }
}

/* /dev/full takes nothing: the failure shows at close at the latest, whatever the size. */
/* A figure that a run has nothing for takes an older one with it. */
static void test_a_figure_left_out(void **state) {
    (void)state;
    char place[300], path[400];
    snprintf(place, sizeof place, "%s", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
    snprintf(path, sizeof path, "%s/riddle-left-out.svg", place);
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fclose(f);
    common_set_quiet(true);
    for (int k = 0; k < 2; k++) figure_left_out(place, "riddle-left-out.svg", "nothing has happened");
    common_set_quiet(false);
    f = fopen(path, "r");
    assert_null(f);
}

static void test_output_full_disk(void **state) {
    (void)state;
    if (access("/dev/full", W_OK) != 0) skip();
    static const char block[100000];
    riddle_io_file *f = riddle_io_open(NULL, "/dev/full");
    assert_non_null(f);
    riddle_io_print(f, "short");
    assert_int_not_equal(riddle_io_close(f), 0);
    f = riddle_io_open(NULL, "/dev/full");
    riddle_io_write(f, block, sizeof block);
    assert_int_not_equal(riddle_io_write(f, block, sizeof block), 0);
    assert_int_not_equal(riddle_io_close(f), 0);
    json *j = json_open("/dev/full");
    json_number(j, "a", 1.0);
    assert_int_not_equal(json_close(j), 0);
    riddle_io_file *c = csv_open(NULL, "/dev/full", "a,b");
    assert_int_not_equal(riddle_io_close(c), 0);
    riddle_plot *p = riddle_plot_new("full", 1, 1);
    assert_int_not_equal(riddle_plot_write(p, NULL, "/dev/full"), 0);
    double xyz[3] = {1.0, 2.0, 3.0};
    assert_int_not_equal(riddle_io_points(NULL, "/dev/full", 1, riddle_io_vector("position", xyz), NULL, 0), 0);
    assert_int_equal(access("/dev/full", W_OK), 0); /* still there */
    assert_int_equal(common_exit_status(), 1);
}

/* ---- JSON ---- */

static void test_json(void **state) {
    (void)state;
    char path[300];
    double values[] = {0.1, -1e300, (double)NAN, HUGE_VAL};
    int whole[] = {1, -2};
    json *j = json_open(riddle_io_path(path, sizeof path, folder, "a.json"));
    json_number(j, "time_s", 0.1);
    json_integer(j, "steps", 9007199254740993LL);
    json_string(j, "text", "\"a\\b\"\n\x01 \xC3\xA9");
    json_string(j, "none", NULL);
    json_bool(j, "yes", true);
    json_array(j, "values", values, 4);
    json_array(j, "empty", NULL, 0);
    json_integers(j, "whole", whole, 2);
    json_object_begin(j, "inner");
    json_number(j, "x", -0.0);
    json_object_end(j);
    json_array_begin(j, "list");
    json_integer(j, NULL, 1);
    json_object_begin(j, NULL);
    json_object_end(j);
    assert_int_equal(json_close(j), 0); /* closes the list */
    expect_file("a.json",
                "{\n  \"time_s\": 0.10000000000000001,\n  \"steps\": 9007199254740993,\n"
                "  \"text\": \"\\\"a\\\\b\\\"\\u000a\\u0001 \xC3\xA9\",\n  \"none\": null,\n  \"yes\": true,\n"
                "  \"values\": [0.10000000000000001, -1.0000000000000001e+300, null, null],\n  \"empty\": [],\n  "
                "\"whole\": [1, -2],\n"
                "  \"inner\": {\n    \"x\": -0\n  },\n  \"list\": [\n    1,\n    {\n    }\n  ]\n}\n");
}

static void test_json_absent(void **state) {
    (void)state;
    json *j = json_open(NULL);
    assert_null(j);
    json_number(j, "a", 1.0);
    json_integer(j, "a", 1);
    json_bool(j, "a", true);
    json_string(j, "a", "b");
    json_array(j, "a", NULL, 0);
    json_integers(j, "a", NULL, 0);
    json_object_begin(j, "a");
    json_object_end(j);
    json_array_begin(j, "a");
    json_array_end(j);
    json_discard(j);
    assert_int_equal(json_close(j), 0);
    char path[300];
    j = json_open(riddle_io_path(path, sizeof path, folder, "deep.json"));
    for (int i = 0; i < 100; i++) json_array_begin(j, NULL); /* deeper than it goes: stays balanced */
    for (int i = 0; i < 200; i++) json_array_end(j);
    assert_int_equal(json_close(j), 0);
    char *text = slurp("deep.json", NULL);
    int open = 0, lowest = 0;
    for (char *c = text; *c; c++) {
        open += (*c == '[' || *c == '{') - (*c == ']' || *c == '}');
        if (open < lowest) lowest = open;
    }
    free(text);
    assert_int_equal(open, 0);
    assert_int_equal(lowest, 0);
}

/* ---- CSV ---- */

static void test_csv_round_trip(void **state) {
    (void)state;
    double rows[3][3] = {{0.1, -1e-300, 3.0}, {(double)NAN, DBL_MAX, 4.9e-324}, {HUGE_VAL, -0.0, 1.0 / 3.0}};
    riddle_io_file *c = csv_open(folder, "a.csv", "# a comment\ntime_s,mass_kg,x [m]");
    for (int i = 0; i < 3; i++) assert_int_equal(riddle_io_row(c, rows[i], 3), 0);
    csv_line(c, "%d,%s,%g", 7, "", 2.5);
    assert_int_equal(riddle_io_close(c), 0);
    char path[300], message[200];
    csv_data data;
    assert_int_equal(csv_read(riddle_io_path(path, sizeof path, folder, "a.csv"), &data, message, sizeof message), 0);
    assert_int_equal(data.rows, 4);
    assert_int_equal(data.columns, 3);
    assert_int_equal(csv_column(&data, "x [m]"), 2);
    assert_int_equal(csv_column(&data, "X_m"), 2); /* case and unit are taken off */
    assert_int_equal(csv_column(&data, "x"), 2);
    assert_int_equal(csv_column(&data, "xx"), -1);
    assert_true(csv_value(&data, 3, "x_mm") == 2500.0 && csv_value(&data, 3, "time_ms") == 7000.0);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            double back = data.values[3 * i + k], out = rows[i][k];
            assert_true(out - out == 0.0 ? memcmp(&back, &out, sizeof out) == 0 : back != back);
        }
    assert_true(csv_value(&data, 3, "time_s") == 7.0 && isnan(csv_value(&data, 3, "mass_kg")) &&
                isnan(csv_value(&data, 4, "time_s")) && isnan(csv_value(&data, 0, "none")));
    csv_free(&data);
    csv_free(&data); /* twice does no harm */
}

static int parse_csv(const char *text, csv_data *data, char *message) {
    return csv_parse(text, (long)strlen(text), "f", data, message, 200);
}

/* Two spheres, as other programs write them: these numbers, or one line that says what is wrong. */
static void test_particles_as_others_write_them(void **state) {
    static const char *const right[] = {
        "x,y,z,diameter,group\n0.1,0.25,0.5,0.005,0\n0.2,0.25,0.5,0.005,1\n",
        "\xEF\xBB\xBFx,y,z,diameter,group\n0.1,0.25,0.5,0.005,0\n0.2,0.25,0.5,0.005,1\n",
        ("x_velocity_m_s,y_velocity_m_s,z_velocity_m_s,x_m,y_m,z_m,diameter_nominal,diameter_m,group\n"
         "7,8,9,0.1,0.25,0.5,1,0.005,0\n7,8,9,0.2,0.25,0.5,1,0.005,1\n"),
        "X [mm];Y [mm];Z [mm];Diameter [um];class\r\n100;250,0;500;5000;0\r\n200;250;500,0;5,0e3;1\r\n",
        "x\ty\tz\tradius_mm\tgroup\r0.1\t0,25\t0.5\t2.5\t0\r0.2\t0.25\t0.5\t2,5\t1",
        "x [ mm ],y_mm,z( m),diameter [\xB5m],Group [-]\n100,250,0.5,5000,0\n\"200\" ,250,0.5,5000,1\n", /* Latin-1 */
    };
    static const char *const wrong[][2] = {
        {"x,y,z,diameter,group\n0.1,0.25,0.5,0.005,small\n", "f.csv:2: column group: 'small' is not a whole number"},
        {"x,y,z,diameter\n0.1,0.25,,0.005\n", "f.csv:2: column z: '' is not a number"},
        {"x,y,z,diameter\n0.1,0.25,0.5,0.005\n0.1,0.25,here,0.005\n", "f.csv:3: column z: 'here' is not a number"},
        {"x_velocity,y,z,diameter\n1,2,3,4\n", "f.csv: no column x; the columns are x_velocity, y, z, diameter"},
        {"x,y,z,size\n1,2,3,4\n", "f.csv: no column diameter or radius; the columns are x, y, z, size"},
        {"x [furlong],y,z,diameter\n1,2,3,4\n",
         "f.csv: the unit of column x cannot be converted; the columns are x [furlong], y, z, diameter"},
        {"x_m,x_mm,y,z,diameter\n1,2,3,4,5\n",
         "f.csv: two columns are named x; the columns are x_m, x_mm, y, z, diameter"},
        {"\xFF\xFEx,y,z", "f.csv: not a text file in UTF-8"},
        {"x,x,y,z,diameter\n1,2,3,4,5\n", "f.csv: two columns are named x; the columns are x, x, y, z, diameter"},
        {"x [mm2],y,z,diameter\n1,2,3,4\n", "f.csv: the unit of column x [mm2] cannot be that of x"},
        {"x,y,z,diameter_s\n1,2,3,4\n", "f.csv: the unit of column diameter_s cannot be that of diameter"},
        {"x,y,z,vx_m,diameter\n1,2,3,4,5\n", "f.csv: the unit of column vx_m cannot be that of vx"},
        {"x,y,z,diameter,radius\n1,2,3,4,3\n", "f.csv:2: the diameter is not twice the radius"},
        {"x,y,z,diameter\n\"1\"5,2,3,4\n", "f.csv:2: column x: '\"1\"5' is not a number"},
        {"x,y,z,diameter,group_t\n1,2,3,4,1\n", "f.csv: the unit of column group_t cannot be that of group"},
        {"x;y;z;diameter\n1,5;2;3;4\n1;2;1.250;4\n",
         "f.csv:3: column z: '1.250' may be in thousands: other numbers have decimal commas"},
        {"x\ty\tz\tdiameter\n1,250\t2\t3.5\t4\n",
         "f.csv:2: column x: '1,250' may be in thousands: other numbers have decimal points"},
    };
    char message[900];
    particles p;
    (void)state;
    for (size_t k = 0; k < sizeof right / sizeof *right; k++) {
        assert_int_equal(particles_parse(right[k], strlen(right[k]), "f.csv", &p, message, sizeof message), 0);
        assert_int_equal(p.n, 2);
        for (int i = 0; i < 2; i++) {
            const double expected[3] = {i ? 0.2 : 0.1, 0.25, 0.5};
            for (int a = 0; a < 3; a++) assert_true(fabs(p.centre[3 * i + a] - expected[a]) < 1e-12);
            assert_true(fabs(p.diameter[i] - 0.005) < 1e-15 && p.group[i] == i && p.velocity[3 * i] == 0.0);
        }
        particles_free(&p);
    }
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        assert_int_equal(particles_parse(wrong[k][0], strlen(wrong[k][0]), "f.csv", &p, message, sizeof message), -1);
        assert_string_equal(message, wrong[k][1]);
    }
}

/* Arrays of a .vtp file under other names and types: read as they are meant, or refused; never left out
   without a word. */
static void test_vtp_arrays_as_others_write_them(void **state) {
    (void)state;
    double x[] = {0.1, 0.2}, y[] = {0.25, 0.25}, z[] = {0.5, 0.5}, size[] = {5000.0, 5000.0}, radius[] = {2.5, 2.5},
           wide[] = {3.0, 3.0};
    double velocity[] = {1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
    float group[] = {0.0f, 1.0f}, part[] = {0.0f, 0.5f};
    struct {
        riddle_io_array array[4];
        int n;
        const char *message; /* NULL: right */
    } cases[] = {
        {{riddle_io_scalar("Diameter [um]", size), riddle_io_scalar("radius_mm", radius),
          riddle_io_vector("velocity_mm_s", velocity), riddle_io_scalar_float("Group", group)},
         4,
         NULL},
        {{riddle_io_scalar("diameter_um", size), riddle_io_scalar_float("group", part)},
         2,
         "f.vtp: the array group is damaged or of another type"},
        {{riddle_io_scalar("diameter_um", size), riddle_io_scalar("radius_mm", wide)},
         2,
         "f.vtp: the array radius_mm is damaged or of another type"},
        {{riddle_io_scalar("diameter_um", size), riddle_io_scalar("diameter_mm", radius)},
         2,
         "f.vtp: two arrays are named diameter"},
        {{riddle_io_scalar("diameter_um", size), riddle_io_vector("velocity_mm", velocity)},
         2,
         "f.vtp: the unit of array velocity_mm cannot be that of velocity"},
        {{riddle_io_scalar("diameter_s", size)}, 1, "f.vtp: the unit of array diameter_s cannot be that of diameter"},
        {{riddle_io_vector("velocity", velocity)}, 1, "f.vtp: no diameter or radius"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char message[400] = "";
        long bytes;
        particles p;
        assert_int_equal(
            riddle_io_points(folder, "f.vtp", 2, riddle_io_vector3("position", x, y, z), cases[k].array, cases[k].n),
            0);
        char *text = slurp("f.vtp", &bytes);
        assert_int_equal(particles_parse(text, (size_t)bytes, "f.vtp", &p, message, sizeof message),
                         cases[k].message ? -1 : 0);
        assert_string_equal(message, cases[k].message ? cases[k].message : "");
        if (!cases[k].message) {
            assert_true(p.n == 2 && p.group[0] == 0 && p.group[1] == 1);
            assert_true(fabs(p.diameter[1] - 0.005) < 1e-9 && fabs(p.velocity[4] - 0.005) < 1e-9 &&
                        fabs(p.centre[3] - 0.2) < 1e-7);
        }
        particles_free(&p);
        free(text);
    }
}

static void test_csv_forms(void **state) {
    (void)state;
    char message[200];
    csv_data data;
    assert_int_equal(parse_csv("# c\r\n\r\n a , \"b, c\" ,d # note, with a comma\r\n1, 2 ,x\r\n # c\n-3e2,,\"y, z\"",
                               &data, message),
                     0);
    assert_int_equal(data.columns, 3);
    assert_int_equal(data.rows, 2);
    assert_string_equal(data.names[0], "a");
    assert_string_equal(data.names[1], "b, c");
    assert_string_equal(data.names[2], "d");
    assert_true(data.values[0] == 1.0 && data.values[1] == 2.0 && data.values[3] == -300.0 && isnan(data.values[4]) &&
                isnan(data.values[5]));
    assert_string_equal(data.cells[5], "y, z");
    csv_free(&data);
    assert_int_equal(parse_csv("a\n", &data, message), 0);
    assert_int_equal(data.rows, 0);
    csv_free(&data);
    static const char *const bad[][2] = {
        {"", "f: no header line"},
        {"# only\n", "f: no header line"},
        {"a,b\n1,2\n\n3\n", "f:4: 1 cells, but the header names 2"},
        {"a,b\n1,2,3\n", "f:2: 3 cells, but the header names 2"},
        {"a,b\n1,2\n1,2x\n", "f:3: column b: '2x' is not a number"},
        {"a,b\n1,2\n1,0x10\n", "f:3: column b: '0x10' is not a number"},
    };
    for (int i = 0; i < (int)(sizeof bad / sizeof *bad); i++) {
        assert_int_equal(parse_csv(bad[i][0], &data, message), -1);
        assert_string_equal(message, bad[i][1]);
        assert_null(data.memory);
    }
    /* comments behind rows: only of numbers */
    assert_int_equal(parse_csv("a,b # names\n1,2 # one, two\n3,4.5\t#\n5,\n", &data, message), 0);
    assert_true(data.rows == 3 && csv_value(&data, 0, "b") == 2.0 && csv_value(&data, 1, "b") == 4.5 &&
                isnan(csv_value(&data, 2, "b")));
    csv_free(&data);
    assert_int_equal(parse_csv("a;b\n1;x #1\n2;7 #2\n", &data, message), 0);
    assert_string_equal(data.cells[1], "x #1");
    assert_string_equal(data.cells[3], "7 #2");
    csv_free(&data);
    assert_int_equal(parse_csv("a,b\n1,2#\n3,4 5 # six\n", &data, message), 0);
    assert_string_equal(data.cells[1], "2#");
    csv_free(&data);
    assert_int_equal(csv_parse("a\0b", 3, "f", &data, message, 200), -1);
    assert_string_equal(message, "f: not a text file");
    assert_int_equal(csv_read("/nowhere", &data, message, 200), -1);
    assert_string_equal(message, "/nowhere: No such file or directory");
    assert_int_equal(csv_read(folder, &data, message, 200), -1);
}

static void test_table(void **state) {
    (void)state;
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    riddle_io_table t = riddle_io_table_begin("name|value [m]|n");
    riddle_io_table_cell(&t, "a");
    riddle_io_table_cell(&t, "%.2f", 1.5);
    riddle_io_table_cell(&t, "%d", 30);
    riddle_io_table_cell(&t, "\xC3\xA9tage");
    riddle_io_table_cell(&t, "%.2f", -10.0);
    riddle_io_table_cell(&t, "-");
    riddle_io_table_cell(&t, "b");
    riddle_io_table_cell(&t, "%d", 3);
    riddle_io_table_cell(&t, "%s", "");
    riddle_io_table_end(&t, f);
    fclose(f);
    assert_string_equal(text, "name   value [m]   n\n"
                              "-----  ---------  --\n"
                              "a           1.50  30\n"
                              "\xC3\xA9tage     -10.00   -\n"
                              "b              3\n");
    free(text);
}

/* ---- ParaView ---- */

static uint64_t little(const char *bytes, int n) {
    uint64_t v = 0;
    for (int i = n - 1; i >= 0; i--) v = v << 8 | (unsigned char)bytes[i];
    return v;
}

static double float_at(const char *bytes) {
    uint32_t bits = (uint32_t)little(bytes, 4);
    float v;
    memcpy(&v, &bits, 4);
    return (double)v;
}

/* Start of a named array's numbers in the appended block; checks its length. */
static const char *array_of(const char *text, const char *name, uint64_t bytes) {
    char key[80];
    snprintf(key, sizeof key, "Name=\"%s\"", name);
    const char *at = strstr(text, key);
    assert_non_null(at);
    at = strstr(at, "offset=\"");
    assert_non_null(at);
    long offset = strtol(at + 8, NULL, 10);
    const char *block = strstr(text, "<AppendedData encoding=\"raw\">\n_");
    assert_non_null(block);
    const char *here = block + strlen("<AppendedData encoding=\"raw\">\n_") + offset;
    assert_true(little(here, 8) == bytes);
    return here + 8;
}

static void test_vtp(void **state) {
    (void)state;
    double x[] = {1.0, 2.0, 3.0}, y[] = {0.5, 0.0, -0.5}, z[] = {0.0, 0.0, 7.0}, radius[] = {0.1, 0.2, 0.3};
    double both[] = {1.0, 2.0, 3.0, 99.0, 4.0, 5.0, 6.0, 99.0, 7.0, 8.0, 9.0, 99.0};
    int klass[] = {0, -1, 2};
    float f[] = {1.5f, 2.5f, 3.5f};
    riddle_io_array arrays[] = {riddle_io_scalar("radius", radius), riddle_io_ints("class", klass),
                                riddle_io_vector_stride("velocity<&", both, 4), riddle_io_scalar_float("f", f)};
    assert_int_equal(riddle_io_points(folder, "a.vtp", 3, riddle_io_vector3("position", x, y, z), arrays, 4), 0);
    long size;
    char *text = slurp("a.vtp", &size);
    assert_non_null(strstr(text, "byte_order=\"LittleEndian\" header_type=\"UInt64\""));
    assert_non_null(strstr(text, "NumberOfPoints=\"3\" NumberOfVerts=\"3\" NumberOfLines=\"0\""));
    const char *a = array_of(text, "radius", 12);
    for (int i = 0; i < 3; i++) assert_true(fabs(float_at(a + 4 * i) - radius[i]) < 1e-7);
    a = array_of(text, "class", 12);
    for (int i = 0; i < 3; i++) assert_int_equal((int32_t)little(a + 4 * i, 4), klass[i]);
    a = array_of(text, "velocity&lt;&amp;", 36);
    for (int i = 0; i < 9; i++) assert_true(float_at(a + 4 * i) == both[i + i / 3]);
    a = array_of(text, "f", 12);
    assert_true(float_at(a + 8) == 3.5);
    a = array_of(text, "position", 36);
    assert_true(float_at(a) == 1.0 && float_at(a + 4) == 0.5 && float_at(a + 32) == 7.0);
    a = array_of(text, "connectivity", 12);
    assert_true(little(a, 4) == 0 && little(a + 8, 4) == 2);
    a = array_of(text, "offsets", 12);
    assert_true(little(a, 4) == 1 && little(a + 8, 4) == 3);
    assert_memory_equal(a + 12, "\n</AppendedData>\n</VTKFile>\n", 28);
    assert_true(a + 12 + 28 == text + size);
    free(text);
    assert_int_equal(riddle_io_points(folder, "empty.vtp", 0, riddle_io_vector3("position", x, y, z), NULL, 0), 0);
}

static void test_vtp_polygons_and_image(void **state) {
    (void)state;
    double xyz[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    int corners[] = {0, 1, 2, 0, 2, 3}, ends[] = {3, 6};
    assert_int_equal(
        riddle_io_polygons(folder, "p.vtp", 4, riddle_io_vector("position", xyz), 2, ends, corners, NULL, 0), 0);
    assert_int_equal(riddle_io_lines(folder, "l.vtp", 4, riddle_io_vector("position", xyz), 2, ends, corners, NULL, 0),
                     0);
    char *text = slurp("p.vtp", NULL);
    assert_non_null(strstr(text, "NumberOfPolys=\"2\""));
    const char *a = array_of(text, "connectivity", 24);
    assert_true(little(a + 20, 4) == 3);
    a = array_of(text, "offsets", 8);
    assert_true(little(a, 4) == 3 && little(a + 4, 4) == 6);
    free(text);
    text = slurp("l.vtp", NULL);
    assert_non_null(strstr(text, "NumberOfLines=\"2\""));
    free(text);
    int size[3] = {2, 3, 1};
    double origin[3] = {0.0, -1.0, 0.0}, spacing[3] = {0.5, 0.25, 1.0}, values[6] = {1, 2, 3, 4, 5, 6};
    riddle_io_array pressure = riddle_io_scalar("pressure_Pa", values);
    assert_int_equal(riddle_io_cells(folder, "i.vti", size, origin, spacing, &pressure, 1), 0);
    text = slurp("i.vti", NULL);
    assert_non_null(strstr(text, "WholeExtent=\"0 2 0 3 0 1\" Origin=\"0 -1 0\" Spacing=\"0.5 0.25 1\""));
    a = array_of(text, "pressure_Pa", 24);
    assert_true(float_at(a + 20) == 6.0);
    free(text);
    size[0] = 0;
    assert_int_not_equal(riddle_io_cells(folder, "none.vti", size, origin, spacing, &pressure, 1), 0);
    assert_int_equal(files_in(folder), 3);
}

static void test_pvd(void **state) {
    (void)state;
    double xyz[3] = {0.0, 0.0, 0.0};
    riddle_io_series *series = riddle_io_series_open(folder, "run.pvd");
    for (int i = 0; i < 3; i++)
        assert_int_equal(riddle_io_points(folder, riddle_io_series_name(series, 0.1 * i), 1,
                                          riddle_io_vector("position", xyz), NULL, 0),
                         0);
    assert_int_equal(riddle_io_series_close(series), 0);
    expect_file("run.pvd", "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
                           "byte_order=\"LittleEndian\">\n<Collection>\n"
                           "<DataSet timestep=\"0\" part=\"0\" file=\"run_0000.vtp\"/>\n<DataSet timestep=\"0.1\" "
                           "part=\"0\" file=\"run_0001.vtp\"/>\n"
                           "<DataSet timestep=\"0.2\" part=\"0\" file=\"run_0002.vtp\"/>\n</Collection>\n</VTKFile>\n");
    assert_int_equal(files_in(folder), 4);
}

/* ---- the machine ---- */

typedef struct {
    int done[100];
    int fails;
} slots;

static int job(int index, void *user) {
    slots *s = user;
    s->done[index]++;
    return index == 7 ? s->fails : 0;
}

static void test_jobs(void **state) {
    (void)state;
    for (int threads = 0; threads < 5; threads++) {
        slots s = {{0}, threads == 3};
        assert_int_equal(jobs_run(100, threads, job, &s), threads == 3);
        for (int i = 0; i < 100; i++) assert_int_equal(s.done[i], 1);
    }
    assert_int_equal(jobs_run(0, 4, job, NULL), 0);
    assert_true(machine_cores() >= 1 && machine_peak_memory_bytes() > 1e5);
    double t = machine_seconds();
    assert_true(machine_seconds() >= t);
}

static void test_progress(void **state) {
    (void)state;
    progress bar;
    progress_begin(&bar, "nothing", 0.0); /* no total, NaN, beyond the end: no crash */
    progress_update(&bar, (double)NAN);
    progress_update(&bar, 1e300);
    progress_add(&bar, -5.0);
    progress_end(&bar);
    progress_end(&bar);
    assert_false(bar.active);
    assert_false(common_interrupted());
}

/* Seeds of runs: none under seed s is one under s + 1, nor of another run. */
static void test_seeds_of_runs(void **state) {
    (void)state;
    for (uint64_t s = 0; s < 6; s++) {
        for (uint64_t r = 0; r < 6; r++) {
            for (uint64_t k = 0; k < 60 * 60; k++) {
                if (k / 60 == s && k % 60 == r) continue;
                assert_true(program_seed_of(s, r) != program_seed_of(k / 60, k % 60));
            }
        }
    }
    assert_true(program_seed_of(1, 0) == program_seed_of(1, 0));
    assert_true(program_seed_of(UINT64_MAX, 1) != program_seed_of(0, 0));
}

/* Means of what is steady; none of what climbs, drifts or has hardly begun. */
static void test_steady(void **state) {
    enum { N = 400 };
    double level[N], climb[N], time[N], sum[N], slower[N], jump[N];
    uint64_t random = 1;
    (void)state;
    for (int k = 0; k < N; k++) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        const double noise = (double)(random >> 40) / 16777216.0 - 0.5;
        level[k] = 30.0 + 4.0 * noise;
        climb[k] = 30.0 * (1.0 - exp(-k / 200.0)) + 4.0 * noise;
        jump[k] = (k < N / 2 ? 20.0 : 25.0) + noise;
        time[k] = (k ? time[k - 1] : 0.0) + 0.01 * (1.0 + noise);
        sum[k] = k * 2e-3;
        slower[k] = 1.0 - exp(-0.5 * time[k]);
    }
    const steady_mean right = steady_mean_of(level, N);
    assert_true(right.is_steady && fabs(right.mean - 30.0) < 4.0 * right.error && right.error > 0.01 &&
                right.error < 0.15);
    assert_false(steady_mean_of(climb, N).is_steady);
    assert_false(steady_mean_of(jump, N).is_steady);
    assert_true(isnan(steady_mean_of(level, 15).error) && !steady_mean_of(level, 15).is_steady &&
                isnan(steady_mean_of(level, 0).mean));
    int refused = 0; /* of steady ones one in two hundred is taken for a climb */
    for (int trial = 0; trial < 2000; trial++) {
        double noise[64];
        for (int k = 0; k < 64; k++)
            random = random * 6364136223846793005u + 1442695040888963407u,
            noise[k] = (double)(random >> 40) / 16777216.0;
        for (int k = 0; k < 64; k++) noise[k] -= 0.5; /* about 0: the 1 % of the mean do not help */
        refused += !steady_mean_of(noise, 64).is_steady;
    }
    assert_true(refused > 1 && refused < 25);
    const steady_flow flow = steady_flow_of(time, sum, 0, N - 1);
    assert_true(flow.is_enough && flow.is_steady && fabs(flow.rate - 0.2) < 4.0 * flow.error && flow.error < 0.01);
    assert_true(!steady_flow_of(time, slower, 0, N - 1).is_steady &&
                isnan(steady_flow_of(time, slower, 0, N - 1).rate));
    assert_true(!steady_flow_of(time, sum, 0, 59).is_enough && isnan(steady_flow_of(time, sum, 0, 59).rate));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_seeds_of_runs),
        cmocka_unit_test(test_options_good),
        cmocka_unit_test(test_option_of_a_size),
        cmocka_unit_test(test_options_bad),
        cmocka_unit_test_setup_teardown(test_output_whole_or_absent, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_output_through_a_link, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_output_refused, make_folder, remove_folder),
        cmocka_unit_test(test_a_figure_left_out),
        cmocka_unit_test(test_output_full_disk),
        cmocka_unit_test_setup_teardown(test_json, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_json_absent, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_csv_round_trip, make_folder, remove_folder),
        cmocka_unit_test(test_particles_as_others_write_them),
        cmocka_unit_test_setup_teardown(test_vtp_arrays_as_others_write_them, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_csv_forms, make_folder, remove_folder),
        cmocka_unit_test(test_steady),
        cmocka_unit_test(test_table),
        cmocka_unit_test_setup_teardown(test_vtp, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_vtp_polygons_and_image, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_pvd, make_folder, remove_folder),
        cmocka_unit_test(test_jobs),
        cmocka_unit_test(test_progress),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
