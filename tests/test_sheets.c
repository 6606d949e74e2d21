/* The reader of laboratory tables: files in tests/sheets as laboratories write them give the numbers that a person
   reads in them, or one line that is true. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "csv.h"
#include "sheet.h"

static void near(const char *what, double value, double expected) {
    if (!(fabs(value - expected) <= 1e-9 * fabs(expected) + 1e-12))
        fail_msg("%s: %.15g, not %.15g", what, value, expected);
}

/* The same sand in many tables: sieves of 1, 2, 4, 8, 16 mm. */
static void test_one_sand_in_many_tables(void **state) {
    static const char *const files[] = {
        "excel_german.csv", "utf16_tabs.txt",  "thousands.csv",     "below_63.csv",        "intervals.csv",
        "two_lines.csv",    "units_below.csv", "percent_cells.csv", "comments_before.csv", "coarser.csv",
        "phi.csv",          "low_high.csv",    "blanks.txt",        "quoted_heading.csv",  "cumulated_masses.csv",
        "mesh_numbers.csv", "tyler.csv"};
    static const double passing[5] = {0.1, 0.25, 0.5, 0.9, 1.0};
    (void)state;
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) {
        char path[100], message[600];
        sheet_sizes s;
        snprintf(path, sizeof path, "tests/sheets/%s", files[f]);
        if (sheet_read_sizes(path, NULL, 1, &s, message, sizeof message) != 0) fail_msg("%s", message);
        const int n = strcmp(files[f], "tyler.csv") == 0 ? 3 : strcmp(files[f], "below_63.csv") == 0 ? 4 : 5;
        double width[5] = {1e-3, 2e-3, 4e-3, 8e-3, 16e-3};
        if (strcmp(files[f], "mesh_numbers.csv") == 0) width[3] = 0.0254 * 5 / 16, width[4] = 0.0254 * 5 / 8;
        assert_false(s.single);
        assert_int_equal(s.n, n);
        for (int k = 0; k < n; k++) near(files[f], s.size[k], width[k]), near(files[f], s.amount[0][k], passing[k]);
        near(files[f], s.above[0], 1.0 - passing[n - 1]);
        assert_non_null(strstr(s.how, files[f]));
        sheet_free_sizes(&s);
        sheet_free_sizes(&s);
    }
}

static void test_sheets_of_users(void **state) {
    static const struct {
        const char *file;
        int n;
        double size[5], passing[5];
    } right[] = {{"sieves_top_down.csv", 4, {4.75e-3, 10e-3, 20e-3, 40e-3}, {0.05, 0.4, 0.98, 1.0}},
                 {"retained.csv", 5, {0.5e-3, 1e-3, 2e-3, 4e-3, 8e-3}, {0.0, 0.032, 0.128, 0.351, 0.714}},
                 {"masses_with_pan.csv", 3, {1.19e-3, 2.38e-3, 4.76e-3}, {51 / 303.5, 141 / 303.5, 241.1 / 303.5}}};
    static const struct {
        const char *file, *line;
    } wrong[] = {
        {"refused_of_what.csv", ":3: a size of 16 of what? The column must name its unit, such as size_mm"},
        {"refused_doubt.csv", ":2: '1.250' may be in thousands: write numbers without a mark for them"},
        {"refused_mesh.csv", ": the mesh numbers may be of ASTM or Tyler: the heading must say which"},
        {"refused_kind.csv", ": column 'R\xc3\xbc"
                             "ckstand [%]': on each sieve, or cumulated? The heading must say cumulative, or there "
                             "must be a row for the pan"},
        {"refused_gap.csv", ":3: the class from 2 mm does not begin where the one below ends, at 1 mm"},
        {"refused_falls.csv", ":3: column 'passing [%]': less is finer than 2 mm (0.1) than 1 mm (0.9)"},
        {"refused_total.csv", ": the rows of 'mass [g]' add up to 0.17 kg, the row of the total says 0.25 kg"},
        {"refused_commas.csv",
         ":2: 3 cells, but the heading names 2: decimal commas need semicolons or tabs between cells"},
        {"refused_columns.csv", ": no column size; the columns are 'Probe', 'Wert', 'Bemerkung'"},
        {"screen_fit_german.csv", ": several columns are sizes; the columns are 'case', 'amplitude_mm', "
                                  "'frequency_hz', 'aperture_mm', 'wire_mm', "
                                  "'time_s', 'size_mm', 'retained_%'"},
        {"nowhere.csv", ": No such file or directory"},
    };
    char path[100], message[600], expected[700];
    sheet_sizes s;
    (void)state;
    for (size_t f = 0; f < sizeof right / sizeof *right; f++) {
        snprintf(path, sizeof path, "tests/sheets/%s", right[f].file);
        if (sheet_read_sizes(path, NULL, 1, &s, message, sizeof message) != 0) fail_msg("%s", message);
        assert_int_equal(s.n, right[f].n);
        for (int k = 0; k < s.n; k++)
            near(path, s.size[k], right[f].size[k]), near(path, s.amount[0][k], right[f].passing[k]);
        sheet_free_sizes(&s);
    }
    for (size_t f = 0; f < sizeof wrong / sizeof *wrong; f++) {
        snprintf(path, sizeof path, "tests/sheets/%s", wrong[f].file);
        snprintf(expected, sizeof expected, "%s%s", path, wrong[f].line);
        assert_int_equal(sheet_read_sizes(path, NULL, 1, &s, message, sizeof message), -1);
        assert_string_equal(message, expected);
        assert_null(s.memory);
    }
}

static int sizes_of(const char *text, const char *const *names, int n, sheet_sizes *s, char *message) {
    return sheet_parse_sizes(text, (long)strlen(text), "f", names, n, s, message, 600);
}

/* What a column is follows from its heading and the numbers; rows may stand in any order. */
static void test_kinds_of_amounts(void **state) {
    static const struct {
        const char *text;
        double size, passing; /* of the last size [mm] */
        int single;
    } cases[] = {
        {"size_mm,passing\n1,0.2\n2,0.7\n", 2.0, 0.7, 0},
        {"size_um,passing_%\n2000,70\n1000,20\n", 2.0, 0.7, 0},
        {"size_mm,cumulative %\n1,20\n2,70\n", 2.0, 0.7, 0},
        {"size_mm,cumulative %\n1,80\n2,30\n", 2.0, 0.7, 0},
        {"size_mm,retained\n1,80\n2,70\n", 2.0, 0.3, 0}, /* 150 % in all: cumulated */
        {"size_mm,retained_%\n1,50\n2,30\nPan,20\n", 2.0, 0.7, 0},
        {"size_mm,retained_%\n1,20\n2,30\n4,35\n", 4.0, 0.65, 0}, /* 15 % have passed all */
        {"Sieb [mm];Masse [g]\n2;30\n1;50\nBoden;20\n", 2.0, 0.7, 0},
        {"Sieb [mm];Masse\n2;30 g\n1;50 g\nBoden;0,02 kg\n", 2.0, 0.7, 0},
        {"Sieb;Durchgang\n1 mm;20\n2 mm;70\n", 2.0, 0.7, 0},
        {"Sieb;Durchgang\n1000 \xc2\xb5m;20\n2 mm;70\n", 2.0, 0.7, 0},
        {"Korn [mm];Anteil [%]\n0/1;20\n1/2;80\n", 2.0, 1.0, 0},
        {"Korn [mm];Anteil [%]\n1 bis 2;80\n< 1;20\n", 2.0, 1.0, 0},
        {"class,share\n\"1-2 mm\",80\n\"<1 mm\",20\n", 2.0, 1.0, 0},
        {"sieve mm,mass fraction\n-2+1,0.8\n-1,0.2\n", 2.0, 1.0, 0},
        {"size_mm,share\n1,30\n2,70\n", 2.0, 70.0, 1},
        {"Sieve No.,passing %\n#4,70\n#10,20\n", 4.75, 0.7, 0},
        {"Sieve,passing %\nNo. 10,20\nNo. 4,70\n", 4.75, 0.7, 0},
        {"mesh,passing %\n40,20\n4,70\n", 4.75, 0.7, 0}, /* there is no Tyler 40 */
        {"Sieve (in),passing %\n3/8,20\n1 1/2,70\n", 38.1, 0.7, 0},
        {"phi,passing %\n0,20\n-1.5,70\n", 2.8284271247461903, 0.7, 0},
        {"phi;passing %\n\xe2\x88\x92"
         "1,0;70\n1,0;20\n",
         2.0, 0.7, 0}, /* a minus sign of typography */
        {"x / mm\tQ3 / 1\n1\t0,2\n2\t0,7\n", 2.0, 0.7, 0},
        {"Size (mm);Passing (%);Passing sd\n1;20;1\n2;70;1\n", 2.0, 0.7, 0},
        {"Diameter [mm];Remarks;Finer than [%]\n1;wet;20\n2;;70\nTotal;;\n", 2.0, 0.7, 0},
        {"sieve_mm,passing,retained_g\n1,20,50\n2,70,30\n", 2.0, 0.7, 0},
    };
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        char message[600];
        sheet_sizes s;
        if (sizes_of(cases[k].text, NULL, 1, &s, message)) fail_msg("%s: %s", cases[k].text, message);
        assert_int_equal(s.single, cases[k].single);
        near(cases[k].text, 1e3 * s.size[s.n - 1], cases[k].size);
        near(cases[k].text, s.amount[0][s.n - 1], cases[k].passing);
        for (int i = 1; i < s.n; i++) assert_true(s.size[i] > s.size[i - 1]);
        sheet_free_sizes(&s);
    }
    static const char *const wrong[][2] = {
        {"", "f: no lines with cells"},
        {"size_mm,passing\n", "f: no rows below the heading"},
        {"size_mm,passing\n1,0.5\n1,0.6\n", "f:3: the size 1 mm is there twice"},
        {"size_mm,passing\n1,0.5 x\n", "f:2: column 'passing': '0.5 x' is not a number"},
        {"size_mm,passing\nx,0.5\n", "f:2: column 'size_mm': 'x' is no size"},
        {"size_mm,passing\n1,-0.5\n", "f:2: column 'passing': '-0.5' is below 0"},
        {"size_mm,passing\n1,50\n2,150\n",
         "f:3: column 'passing': 1.5 of the whole is finer than 2 mm; it is 0 to 1, or 0 to 100 %"},
        {"size_s,passing\n1,50\n", "f: no column size; the columns are 'size_s', 'passing'"},
        {"size_mm,passing_s\n1,50\n",
         "f: no column passing, coarser, retained, mass or share; the columns are 'size_mm', 'passing_s'"},
        {"size_mm,size2_mm,diameter_mm,passing\n1,1,1,50\n",
         "f: several columns are sizes; the columns are 'size_mm', 'size2_mm', 'diameter_mm', 'passing'"},
        {"size_mm,retained_g\n1,0\nPan,0\n", "f: column 'retained_g': all amounts are 0"},
        {"size_mm,cum. mass retained g\n1,5\n",
         "f: column 'cum. mass retained g': cumulated masses need a row for the pan"},
        {"size_mm,retained\n1,20\n2,300\n4,50\n", "f: column 'retained': neither adds up to 100 % nor falls as sizes "
                                                  "rise; masses need a unit, such as retained_g"},
        {"class mm,share %\n0-1,20\n1-2,30\n", "f: column 'share %' adds up to 50 %, not to 100"},
        {"sieve mass g,sieve soil mass g,size mm\n10,5,1\n",
         "f:2: column 'sieve soil mass g': '5' is less than the empty sieve"},
        {"Tyler mesh,passing %\n40,50\n", "f:2: column 'Tyler mesh': '40' is no sieve of Tyler"},
    };
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        char message[600] = "read";
        sheet_sizes s;
        sizes_of(wrong[k][0], NULL, 1, &s, message);
        assert_string_equal(message, wrong[k][1]);
        assert_null(s.memory);
    }
}

/* Feed, coarse and fine of a classifier: classes or what passes, with deviations or without. */
static void test_amounts_by_name(void **state) {
    static const char *const names[4] = {"feed", "coarse", "fine", "feed_sd"};
    char message[600];
    sheet_sizes s;
    (void)state;
    if (sheet_read_sizes("tests/sheets/feed_coarse_fine.csv", names, 4, &s, message, sizeof message))
        fail_msg("%s", message);
    assert_true(s.n == 5 && !s.single && !s.amount[3]);
    near("feed", s.amount[0][2], 0.6), near("coarse", s.amount[1][2], 0.3), near("fine", s.amount[2][2], 0.9),
        near("size", s.size[0], 2e-6);
    sheet_free_sizes(&s);
    static const char *const same[] = {
        "low_um,high_um,feed,coarse,fine,feed_sd\n1,2,0.2,0.1,0.4,0.01\n2,4,0.8,0.9,0.6,0.02\n",
        "x [um];Feed passing [%];Coarse passing [%];Fine passing [%]\n4;100;100;100\n2;20;10;40\n",
        "Klasse um\tAufgabe %\tGrobgut %\tFeingut %\tAufgabe sd %\n2-4\t80\t90\t60\t2\n1-2\t20\t10\t40\t1\n"};
    for (int k = 0; k < 3; k++) {
        if (sizes_of(same[k], names, 4, &s, message)) fail_msg("%s", message);
        const int at = s.n - 2;
        near("size", s.size[at], 2e-6), near("feed", s.amount[0][at], 0.2), near("coarse", s.amount[1][at], 0.1),
            near("fine", s.amount[2][at], 0.4);
        near("whole", s.amount[0][s.n - 1], 1.0);
        if (k != 1) near("sd", s.amount[3][at], 0.01), near("sd", s.amount[3][s.n - 1], 0.02);
        else assert_null(s.amount[3]);
        sheet_free_sizes(&s);
    }
    assert_int_equal(sizes_of("low_um,high_um,feed,coarse\n1,2,50,50\n", names, 4, &s, message), -1);
    assert_string_equal(message, "f: no column fine; the columns are 'low_um', 'high_um', 'feed', 'coarse'");
}

static int table_of(const char *text, sheet_column *c, int n, sheet *s, char *message) {
    return sheet_parse(text, (long)strlen(text), "f", c, n, s, message, 600);
}

/* Readings: the same numbers whatever the separators, decimals, units and the language. */
static void test_readings(void **state) {
    static const char *const same[] = {
        "time_s,volume_ml,note\n0,0,start\n90,1250.5,end\n",
        "# a comment\n\ntime_min;volume_l\n0;0\n1,5;1,2505\n",
        "\xef\xbb\xbfZeit t / s\tFiltratvolumen V / ml\r\n0\t0\r\n90\t1250,5\r\n",
        "Zeit;Volumen\ns;ml\n0;0\n90;1250,5\n",
        ("Pr\xfc"
         "fung;A 12\nZeit [s];Filtrat [cm\xb3]\n0;0\n90;1.250,5\n"), /* Latin-1, thousands */
        "sep=,\ntime (s),filtrate volume (L)\n0,0\n90,1.2505\n",
        "t [s]   V [ml]\n 0        0\n90   1250.5\n",
        "time;volume\n0 s;0 ml\n1,5 min;1250,5 ml\n",
        "\"time\n[s]\",\"volume [mL]\"\n\"0\",\"0\"\n\"90\",\"1250,5\"\n",
        "volume_m3,time_s\n0,0\n1.2505e-3,9e1\n\n,,,\n",
    };
    char message[600];
    sheet s;
    (void)state;
    for (size_t k = 0; k < sizeof same / sizeof *same; k++) {
        sheet_column c[3] = {sheet_want("time", 'T', true), sheet_want("volume", 'V', true),
                             sheet_want("pressure", 'P', false)};
        if (table_of(same[k], c, 3, &s, message)) fail_msg("%d: %s", (int)k, message);
        assert_int_equal(s.rows, 2);
        near(same[k], c[0].value[1], 90.0), near(same[k], c[1].value[1], 1.2505e-3);
        assert_true(c[0].value[0] == 0.0 && c[2].index == -1 && !c[2].value);
        assert_non_null(strstr(s.how, "time from '"));
        sheet_free(&s);
        sheet_free(&s);
    }
    static const char *const wrong[][2] = {
        {"time_s,volume\n1,2,3\n",
         "f:2: 3 cells, but the heading names 2: decimal commas need semicolons or tabs between cells"},
        {"time_s;volume\n1;2x\n", "f:2: column 'volume': '2x' is not a number"},
        {"time_s;volume_g\n1;2\n", "f: the unit cannot be one of volume; the columns are 'time_s', 'volume_g'"},
        {"time_s;volume [furlong]\n1;2\n", "f: no column volume; the columns are 'time_s', 'volume [furlong]'"},
        {"time_s;time_min;volume\n1;2;3\n",
         "f: several columns are time; the columns are 'time_s', 'time_min', 'volume'"},
        {"time_s;volume;presure_bar\n1;2;3\n",
         "f: a column pressure, in a unit such as _mm, _percent, _kg_m2; there is 'presure_bar'"},
        {"time_s;volume\n", "f: no rows below the heading in line 1"},
        {"time_velocity;volume\n1;2\n", "f: no column time; the columns are 'time_velocity', 'volume'"},
        {"time;volume\n1.250;2,5\n", "f:2: '1.250' may be in thousands: write numbers without a mark for them"},
    };
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        sheet_column c[3] = {sheet_want("time", 'T', true), sheet_want("volume", 'V', true),
                             sheet_want("pressure", 'P', false)};
        strcpy(message, "read");
        table_of(wrong[k][0], c, 3, &s, message);
        assert_string_equal(message, wrong[k][1]);
        assert_null(s.cell);
    }
    sheet_column share[2] = {sheet_want("case", 't', true), sheet_want("moisture", 's', true)};
    assert_int_equal(table_of("case,moisture\n1,2.5\n", share, 2, &s, message), -1);
    assert_string_equal(
        message, "f: column 'moisture': a share of 2.5; in per cent, its heading says so, such as moisture_percent");
    assert_int_equal(table_of("Fall;Feuchte\nnass 1;2,5 %\n", share, 2, &s, message), 0);
    near("moisture", share[1].value[0], 0.025);
    assert_string_equal(s.cell[share[0].index], "nass 1");
    sheet_free(&s);
    assert_int_equal(sheet_parse("a\0b", 3, "f", share, 2, &s, message, 600), -1);
    assert_string_equal(message, "f: not a text file");
}

/* The German table of a screen that came as a report of a fault. */
static void test_screen_table(void **state) {
    enum { COLUMNS = 8 };
    sheet_column c[COLUMNS] = {sheet_want("case", 't', true),      sheet_want("time", 'T', true),
                               sheet_want("size", 'L', true),      sheet_want("retained", '%', true),
                               sheet_want("amplitude", 'L', true), sheet_want("frequency", 'f', true),
                               sheet_want("aperture", 'L', true),  sheet_want("wire", 'L', false)};
    char message[600];
    sheet s;
    (void)state;
    if (sheet_read("tests/sheets/screen_fit_german.csv", c, COLUMNS, &s, message, sizeof message))
        fail_msg("%s", message);
    assert_int_equal(s.rows, 60);
    near("amplitude", c[4].value[0], 0.8e-3), near("wire", c[7].value[59], 2.5e-3),
        near("retained", c[3].value[0], 0.307);
    near("size", c[2].value[3], 7.4e-3), near("last", c[3].value[59], 0.196), near("time", c[1].value[59], 16.0);
    assert_string_equal(s.cell[59 * s.columns + c[0].index], "3");
    sheet_free(&s);
}

/* An optional column in a unit that the reader does not know is refused by each of its names: a default would take its
   place. */
static void test_optional_columns(void **state) {
    static const char *const wrong[] = {"pressure (mmHg)",
                                        "Druckdifferenz in mmHg",
                                        "Druckdifferenz in bar(g)",
                                        "p (mmHg)",
                                        "p [kg/cm2]",
                                        "Druck mmHg",
                                        "Druck_mmHg",
                                        "differenzdruck (atm)",
                                        "dp (bar g)",
                                        "\xce\x94p (Torr)",
                                        "Drukdifferenz in bar",
                                        "gemessener Druck [at]",
                                        "pressure drop [mmH2O]",
                                        "Delta p [mmHg]"};
    static const char *const passed_over[] = {"Filtrat Temperatur [\xc2\xb0"
                                              "C]",
                                              "filtrate pH",
                                              "Masse Kuchen [g]",
                                              "Probe",
                                              "Dampfdruck [mmHg]",
                                              "d50 [um]"};
    static const char *const moist[] = {"moisture [g/kg]",       "Feuchte [g/kg]",    "Wassergehalt in g/kg",
                                        "water_content (g/kg)",  "Feuchtigkeit, ppm", "Feuchte kg/kg dry",
                                        "water content [mg/kg]", "Fechte [%]"};
    char text[200], message[600];
    sheet s;
    (void)state;
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong + sizeof passed_over / sizeof *passed_over; k++) {
        const bool read = k >= sizeof wrong / sizeof *wrong;
        const char *heading = read ? passed_over[k - sizeof wrong / sizeof *wrong] : wrong[k];
        sheet_column c[4] = {sheet_want("time", 'T', true), sheet_want("volume", 'V', false),
                             sheet_want("mass", 'M', false), sheet_want("pressure", 'P', false)};
        snprintf(text, sizeof text, "time_s;volume_ml;%s\n1;2;3\n", heading);
        const int status = table_of(text, c, 4, &s, message);
        if ((status == 0) != read) fail_msg("'%s' %s", heading, read ? message : "is passed over");
        if (!read && (!strstr(message, "a column pressure") || !strstr(message, heading))) fail_msg("%s", message);
        if (read) assert_true(c[2].index < 0 && c[3].index < 0);
        sheet_free(&s);
    }
    for (size_t k = 0; k < sizeof moist / sizeof *moist; k++) {
        sheet_column c[2] = {sheet_want("time", 'T', true), sheet_want("moisture", 's', false)};
        snprintf(text, sizeof text, "time_s;%s\n1;2\n", moist[k]);
        if (table_of(text, c, 2, &s, message) == 0) fail_msg("'%s' is passed over", moist[k]);
        if (!strstr(message, "a column moisture") || !strstr(message, moist[k])) fail_msg("%s", message);
    }
    sheet_column c[2] = {sheet_want("time", 'T', true), sheet_want("moisture", 's', false)};
    if (table_of("time_s;Feuchte [\xe2\x80\xb0]\n1;2,5\n", c, 2, &s, message)) fail_msg("%s", message);
    near("per mille", c[1].value[0], 2.5e-3);
    sheet_free(&s);
    static const char *const names[2] = {"feed", "feed_sd"};
    sheet_sizes z;
    assert_int_equal(sizes_of("low_um;high_um;Aufgabe;Aufgabe sd [g/kg]\n1;2;1;3\n", names, 2, &z, message), -1);
    assert_string_equal(message,
                        "f: no column feed_sd; the columns are 'low_um', 'high_um', 'Aufgabe', 'Aufgabe sd [g/kg]'");
    assert_int_equal(sizes_of("low_um,high_um,feed,feed_sd_mm\n1,2,1,3\n", names, 2, &z, message), -1);
}

/* 3/4 and 1 1/2 inch, however the file says it. */
static void test_inches(void **state) {
    static const char *const same[] = {
        "Sieve (in);Passing (%)\n3/4;60\n1 1/2;90\n",
        "Sieve (inch);Passing (%)\n3/4;60\n1 1/2;90\n",
        "Sieve (inches);Passing (%)\n3/4;60\n1 1/2;90\n",
        "Sieve, inches;Passing (%)\n3/4;60\n1.5;90\n",
        "Sieve opening, in.;Passing (%)\n0.75;60\n1 1/2;90\n",
        "Sieve (\");Passing (%)\n3/4;60\n1 1/2;90\n",
        "\"Sieve (\"\")\";Passing (%)\n3/4;60\n1 1/2;90\n",
        "Maschenweite [Zoll];Durchgang [%]\n3/4;60\n1 1/2;90\n",
        "Maschenweite in Zoll\tDurchgang in %\n0,75\t60\n1 1/2\t90\n",
        "size_inch,passing_%\n3/4,60\n1 1/2,90\n",
        "Sieve,Passing (%)\n3/4\",60\n1 1/2\",90\n",
        "Sieve;Passing (%)\n3/4\";60\n1 1/2\";90\n",
        "Sieve,Passing (%)\n\"3/4\"\"\",60\n\"1 1/2\"\"\",90\n",
        "\"Sieve\";\"Passing (%)\"\n\"3/4\"\"\";\"60\"\n\"1 1/2\"\"\";\"90\"\n",
        "Sieve,Passing (%)\n3/4 in,60\n1 1/2 in.,90\n",
        "Sieve,Passing (%)\n3/4 inch,60\n1.5 inches,90\n",
        "Sieb;Durchgang [%]\n3/4 Zoll;60\n1,5 Zoll;90\n",
        "Sieve,Passing (%)\n3/4'',60\n1.5'',90\n",
        "Sieve,Passing (%)\n3/4\xe2\x80\xb3,60\n1 1/2\xe2\x80\xb3,90\n",
        "mesh,Passing (%)\n\"3/4\"\"\",60\n1 1/2 inches,90\n",
        "ASTM mesh;Passing (%)\n3/4 Zoll;60\n1,5 Zoll;90\n",
        "from (inch);to (inch);retained (g)\n0;3/4;60\n3/4;1 1/2;30\n1 1/2;2;10\n",
        "class (inch);retained (g)\n0-3/4;60\n3/4 - 1 1/2;30\n1 1/2 to 2;10\n",
        "class;retained (g)\n< 3/4\";60\n3/4\" - 1 1/2\";30\n> 1 1/2\";10\n",
        "class (Zoll);share %\n-3/4;60\n-1 1/2+3/4;30\n+1 1/2;10\n",
    };
    char message[600];
    sheet_sizes s;
    (void)state;
    for (size_t k = 0; k < sizeof same / sizeof *same; k++) {
        if (sizes_of(same[k], NULL, 1, &s, message)) fail_msg("%s: %s", same[k], message);
        near(same[k], s.size[0], 0.01905), near(same[k], s.size[1], 0.0381);
        near(same[k], s.amount[0][0], 0.6), near(same[k], s.amount[0][1], 0.9);
        sheet_free_sizes(&s);
    }
    assert_int_equal(sizes_of("Sieve (inch),Passing %\n1-1/2,60\n", NULL, 1, &s, message), -1);
    assert_string_equal(message, "f:2: column 'Sieve (inch)': '1-1/2' is no size"); /* a class, or 1 1/2? */
    /* limits beside a size in another unit keep theirs */
    if (sizes_of("from [um];to [um];mean size [mm];share %\n1000;2000;1.5;60\n2000;4000;3;40\n", NULL, 1, &s, message))
        fail_msg("%s", message);
    near("low", s.size[0], 1e-3);
    sheet_free_sizes(&s);
    csv_data data;
    static const char quoted[] = "name,\"text, \"\"so\"\" [mm]\",x\n3/4\",\"a;\"\"b\"\"\",3 # note\n";
    if (csv_parse(quoted, (long)strlen(quoted), "f", &data, message, 600)) fail_msg("%s", message);
    assert_string_equal(data.names[1], "text, \"so\" [mm]");
    assert_string_equal(data.cells[0], "3/4\""), assert_string_equal(data.cells[1], "a;\"b\"");
    near("x", csv_value(&data, 0, "x"), 3.0);
    csv_free(&data);
}

/* Shares must be a whole, of classes and of single sizes: a curve whose heading does not say so is none of shares. */
static void test_shares_are_a_whole(void **state) {
    static const char *const wrong[][2] = {
        {"diameter_mm;volume %\n3.5;10\n5;60\n7;100\n",
         "f: column 'volume %' adds up to 170 %, not to 100; a curve says so, such as passing or cumulative"},
        {"diameter_um;volume share %\n60;40\n80;70\n100;95\n",
         "f: column 'volume share %' adds up to 205 %, not to 100"},
        {"diameter_um;number_share\n60;0.4\n80;0.7\n100;0.95\n",
         "f: column 'number_share' adds up to 205 %, not to 100"},
        {"diameter_um;volume_share\n60;0,1\n80;0,6\n100;1\n",
         "f: column 'volume_share' adds up to 170 %, not to 100; a curve says so, such as passing or cumulative"},
        {"diameter_um;share\n60;10\n80;60\n100;100\n",
         "f: column 'share' adds up to 170 %, not to 100; a curve says so, such as passing or cumulative"},
        {"size_mm;Anteil\n1;20 %\n2;30 %\n", "f: column 'Anteil' adds up to 50 %, not to 100"},
        {"size_mm;Anteil [\xe2\x80\xb0]\n1;200\n2;300\n",
         "f: column 'Anteil [\xe2\x80\xb0]' adds up to 50 %, not to 100"},
        {"class mm;share %\n0-1;10\n1-2;60\n2-4;100\n", "f: column 'share %' adds up to 170 %, not to 100"},
        {"class mm;share\n0-1;0.1\n1-2;0.6\n2-4;1\n", "f: column 'share' adds up to 170 %, not to 100"},
        {"class mm;Anteil\n0-1;20 %\n1-2;30 %\n", "f: column 'Anteil' adds up to 50 %, not to 100"},
    };
    static const char *const right[] = {
        "size_mm;volume %\n1;24.5\n2;73.5\n",
        "size_mm;share\n1;0.25\n2;0.75\n",
        "size_mm;share\n1;25\n2;75\n",
        "size_mm;number_share\n1;1\n2;3\n",
        "size_mm;Anteil [\xe2\x80\xb0]\n1;250\n2;750\n",
        "size_mm;share\n1;25 %\n2;75 %\n",
        "size_mm;share [-]\n1;0.25\n2;0.75\n",
    };
    char message[600];
    sheet_sizes s;
    (void)state;
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        strcpy(message, "read");
        sizes_of(wrong[k][0], NULL, 1, &s, message);
        assert_string_equal(message, wrong[k][1]);
    }
    for (size_t k = 0; k < sizeof right / sizeof *right; k++) {
        if (sizes_of(right[k], NULL, 1, &s, message)) fail_msg("%s: %s", right[k], message);
        assert_true(s.single);
        near(right[k], s.amount[0][1] / s.amount[0][0], 3.0);
        sheet_free_sizes(&s);
    }
    if (sizes_of("diameter_um;mass_g\n0;1\n60;40\n80;70\n", NULL, 1, &s, message)) fail_msg("%s", message);
    sheet_free_sizes(&s);
    if (sizes_of("diameter_um,q3\n1,0\n2,0.4\n3,1\n", NULL, 1, &s, message)) fail_msg("%s", message);
    assert_false(s.single); /* as filter_cake promises: q3 of a curve */
    near("q3", s.amount[0][1], 0.4);
    sheet_free_sizes(&s);
}

/* Marks that may separate thousands where no number has decimals. */
static void test_thousands_without_decimals(void **state) {
    static const char *const wrong[] = {
        "Siebweite [um];Masse [g]\n4.000;0\n2.000;12\n1.000;21\n500;8\nBoden;7\n",
        "Siebweite [um];Masse [g]\n4,000;0\n2,000;12\n1,000;21\n500;8\nBoden;7\n",
        "Siebweite [um]\tMasse [g]\n4.000\t0\n63\t12\nBoden\t7\n",
        "size [um];Masse [g]\n400;0\n200;1.250\n100;2.125\n50;875\nBoden;750\n",
        "Kornklasse [um];Masse [g]\n500-1.000;5\n1.000-2.000;7\n",
    };
    static const char *const right[] = {
        "size [mm];mass [g]\n4.000;0\n2.000;12\n1.000;21\n0.500;8\nPan;7\n",
        "size [mm];mass [g]\n4.000;12.125\n2.000;21.250\n1.000;8.375\n",
        "size [mm];mass [g]\n2;12\n3;21\n4.125;8\n150;5\n", /* as thousands they would not rise */
        "size [mm];mass [g]\n4.000;1\n2.000;2\n1.000;3\n",
    };
    char message[600];
    sheet_sizes s;
    (void)state;
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        strcpy(message, "read");
        sizes_of(wrong[k], NULL, 1, &s, message);
        if (!strstr(message, "may be in thousands: write numbers without a mark for them"))
            fail_msg("%s: %s", wrong[k], message);
    }
    for (size_t k = 0; k < sizeof right / sizeof *right; k++) {
        if (sizes_of(right[k], NULL, 1, &s, message)) fail_msg("%s: %s", right[k], message);
        sheet_free_sizes(&s);
    }
    sheet_column c[2] = {sheet_want("time", 'T', true), sheet_want("volume", 'V', true)};
    sheet t;
    assert_int_equal(table_of("Zeit [s];Volumen [ml]\n60;250\n310;750\n520;1.000\n", c, 2, &t, message), -1);
    assert_string_equal(message, "f:4: '1.000' may be in thousands: write numbers without a mark for them");
}

/* Where nothing shows what a mark means, the line that says how a table was read says so. */
static void test_marks_in_doubt_are_told(void **state) {
    static const char *const doubtful[][2] = {
        {"size [mm];mass [g]\n4.000;8.375\n2.500;4.125\n1.250;1.625\n",
         "f: decimal points (no number shows whether '8.375' means 8.375 or 8375: it is read as 8.375), "},
        {"size [mm]\tmass [g]\n4,000\t8,375\n2,500\t4,125\n1,250\t1,625\n",
         "f: decimal commas (no number shows whether '8,375' means 8.375 or 8375: it is read as 8.375), "},
        {"size [mm];mass [g]\n4.000;8.375\n2.500;4.125\n1.250;0.625\n", NULL},
        {"size [mm];mass [g]\n1.250;1\n2;3\n3.125;4\n", NULL},
    };
    char message[600];
    sheet_sizes s;
    (void)state;
    for (size_t k = 0; k < sizeof doubtful / sizeof *doubtful; k++) {
        if (sizes_of(doubtful[k][0], NULL, 1, &s, message)) fail_msg("%s", message);
        const char *said = doubtful[k][1] ? doubtful[k][1] : "f: decimal points, ";
        if (strncmp(s.how, said, strlen(said)) != 0) fail_msg("%s, not %s", s.how, said);
        sheet_free_sizes(&s);
    }
    sheet_column c[2] = {sheet_want("time", 'T', true), sheet_want("volume", 'V', true)};
    sheet t;
    if (table_of("Zeit [s];Volumen [ml]\n60;1.250\n310;2.750\n520;3.125\n", c, 2, &t, message)) fail_msg("%s", message);
    assert_non_null(strstr(t.how, "whether '1.250' means 1.25 or 1250: it is read as 1.25), 3 rows"));
    sheet_free(&t);
}

/* mPa is no MPa; other letters may be of any case. */
static void test_case_of_units(void **state) {
    static const struct {
        const char *unit;
        double si; /* 0: refused */
    } cases[] = {{"mPa", 1e-3}, {"MPa", 1e6}, {"MPA", 0.0},  {"mpa", 0.0},  {"Mpa", 0.0},           {"KPA", 1e3},
                 {"kPa", 1e3},  {"BAR", 1e5}, {"MBAR", 1e2}, {"mbar", 1e2}, {"Psi", 6894.757293168}};
    static const struct {
        const char *unit;
        double si;
    } masses[] = {{"mg", 1e-6}, {"Mg", 1e3}, {"MG", 0.0}, {"Kg", 1.0}, {"KG", 1.0}, {"G", 1e-3}, {"T", 1e3}},
      volumes[] = {{"ml", 1e-6}, {"mL", 1e-6}, {"Ml", 1e3}, {"ML", 0.0}, {"L", 1e-3}, {"CM3", 1e-6}};
    static const char *const ways[] = {"t_s;%s_%s\n1;2\n", "t [s];%s [%s]\n1;2\n", "t in s;%s in %s\n1;2\n",
                                       "t;%s\ns;%s\n1;2\n", "t;%s\n1;2 %s\n"};
    char text[100], message[600];
    sheet s;
    (void)state;
    for (size_t k = 0; k < 24; k++)
        for (size_t way = 0; way < sizeof ways / sizeof *ways; way++) {
            const char kind = k < 11 ? 'P' : k < 18 ? 'M' : 'V';
            const char *name = kind == 'P'   ? "pressure"
                               : kind == 'M' ? "mass"
                                             : "volume",
                       *unit = kind == 'P'   ? cases[k].unit
                               : kind == 'M' ? masses[k - 11].unit
                                             : volumes[k - 18].unit;
            const double si = kind == 'P' ? cases[k].si : kind == 'M' ? masses[k - 11].si : volumes[k - 18].si;
            sheet_column c[2] = {sheet_want("time", 'T', true), sheet_want(name, kind, false)};
            snprintf(text, sizeof text, ways[way], name, unit);
            const int status = table_of(text, c, 2, &s, message);
            if (si == 0.0 && (status == 0 || !strstr(message, unit))) fail_msg("%s: %s", text, status ? message : "");
            if (si > 0.0 && status) fail_msg("%s: %s", text, message);
            if (si > 0.0) near(text, c[1].value[0], 2.0 * si);
            sheet_free(&s);
        }
    double factor;
    assert_int_equal(csv_is("p_mPa", "p_pa", &factor), 1);
    near("csv", factor, 1e-3);
    assert_int_equal(csv_is("P [MPa]", "p_Pa", &factor), 1);
    near("csv", factor, 1e6);
    assert_int_equal(csv_is("p_MPA", "p_Pa", &factor), -1);
}

/* feed, coarse and fine without a unit are shares too; parts or counts are whole numbers and none adds up to 100. */
static void test_feed_is_a_whole(void **state) {
    static const char *const names[3] = {"feed", "coarse", "fine"};
    static const char *const wrong[][2] = {
        {"0.34,0.1,0.4\n2,4,1.36,0.9,0.6", "170"},
        {"0.034,0.1,0.4\n2,4,0.136,0.9,0.6", "17"},
        {"34,10,40\n2,4,136,90,60", "170"},
        {"3,10.5,40\n2,4,14,89.5,60", "17"},
    };
    static const char *const right[] = {"0.2,0.1,0.4\n2,4,0.81,0.9,0.6", "20,10,40\n2,4,80,90,60",
                                        "34,2,80\n2,4,136,18,120"};
    char text[200], message[600];
    sheet_sizes s;
    (void)state;
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        char said[100];
        snprintf(text, sizeof text, "low_um,high_um,feed,coarse,fine\n1,2,%s\n", wrong[k][0]);
        snprintf(said, sizeof said, "f: column 'feed' adds up to %s %%, not to 100", wrong[k][1]);
        strcpy(message, "read");
        sizes_of(text, names, 3, &s, message);
        assert_string_equal(message, said);
    }
    for (size_t k = 0; k < sizeof right / sizeof *right; k++) {
        snprintf(text, sizeof text, "low_um,high_um,feed,coarse,fine\n1,2,%s\n", right[k]);
        if (sizes_of(text, names, 3, &s, message)) fail_msg("%s", message);
        sheet_free_sizes(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_sand_in_many_tables),
        cmocka_unit_test(test_sheets_of_users),
        cmocka_unit_test(test_kinds_of_amounts),
        cmocka_unit_test(test_amounts_by_name),
        cmocka_unit_test(test_readings),
        cmocka_unit_test(test_screen_table),
        cmocka_unit_test(test_optional_columns),
        cmocka_unit_test(test_inches),
        cmocka_unit_test(test_shares_are_a_whole),
        cmocka_unit_test(test_thousands_without_decimals),
        cmocka_unit_test(test_marks_in_doubt_are_told),
        cmocka_unit_test(test_case_of_units),
        cmocka_unit_test(test_feed_is_a_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
