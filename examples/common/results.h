/* results.h: a table of results, described once and written to the screen, to CSV, to JSON and into figures.

       static const result_column columns[] = {
           {"law", "law", "%s"},
           {"evaluation_ns|ns", "ns", "%.1f"},               // "ns" in CSV
           {"rms_error", "rms error [%]", "%.3g", 100.0},    // a share in the files
       };
       result_table *r = RESULTS(columns);
       results_row(r, TEXTS(name), ns, rms);                 // its texts, then its numbers, in the order of the columns
       results_write(r, report, "laws", self.out, "laws.csv");
       riddle_plot_line(figure, NULL, results_column(r, "ns", 1.0), results_column(r, "rms_error", 100.0), rows);
       results_free(r);

   A row that has other cells than the columns ends the program, as missing memory does. */
#ifndef RIDDLE_RESULTS_H
#define RIDDLE_RESULTS_H

#include "json.h"

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wmissing-field-initializers" /* what a column does not need is left out */
#endif

/* key: "json|csv" if the names differ, "json|" or "|csv" in one of them only, NULL in none; "?key" is not in JSON where
   there is none. heading: NULL is not on the screen.
   format: "%s" is a text, "yes|no" a truth value, else that of a number on the screen; NULL: a number of the files.
   scale: of the number on the screen over that of the files; 0 is 1. */
typedef struct result_column {
    const char *key, *heading, *format;
    double scale;
} result_column;

typedef struct result_table result_table;
result_table *results_new(const result_column *columns, int n);
#define RESULTS(columns) results_new(columns, (int)(sizeof(columns) / sizeof *(columns)))
/* Of numbers for a CSV file that begins with this header. */
result_table *results_of(const char *header);
void results_free(result_table *r);

/* texts: TEXTS(a, b), or NULL. A number that is NaN, a text that is NULL: an empty cell, null, "-" on the screen. */
#define results_row(r, texts, ...)                                                                                     \
    results_add(r, texts, (const double[]){__VA_ARGS__}, (int)(sizeof((const double[]){__VA_ARGS__}) / sizeof(double)))
#define TEXTS(...) ((const char *const[]){__VA_ARGS__, results_end})
extern const char results_end[1];
void results_add(result_table *r, const char *const *texts, const double *numbers, int n);

int results_rows(const result_table *r);
/* The numbers of a column by scale, one a row; valid until results_free. */
const double *results_column(result_table *r, const char *key, double scale);

void results_print(const result_table *r);
void results_csv(const result_table *r, const char *folder, const char *name);
/* An array of objects; key NULL: the objects, into an array that is open. */
void results_json(const result_table *r, json *report, const char *key);
/* All three. */
void results_write(const result_table *r, json *report, const char *key, const char *folder, const char *name);

/* Single numbers, to JSON by the key and to the screen, a line each, by the heading, if they have one:
   results_values(report, {"x50_m", x50, "cut size [um]", "%.2f", 1e6}, {"wall_s", wall}); */
typedef struct result_value {
    const char *key;
    double value;
    const char *heading, *format;
    double scale;
} result_value;
#define results_values(report, ...)                                                                                    \
    results_say(report, (const result_value[]){__VA_ARGS__},                                                           \
                (int)(sizeof((const result_value[]){__VA_ARGS__}) / sizeof(result_value)))
void results_say(json *report, const result_value *values, int n);

#endif
