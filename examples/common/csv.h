/* csv.h: tables of numbers from files. Lines that begin with '#' are comments, and so is what follows " #" after the
   last number of a row; the first other line names the columns.

   Cells are separated by commas, semicolons or tabs, whichever the line of names has; with semicolons and tabs numbers
   may have decimal commas; a table that has decimal points, too, must not have numbers such as 1.250 or 1,250, which
   may be thousands. Lines end as on any system; a byte-order mark is passed over.

   A column is found by its exact name, after case and a unit are taken off: "x" is in x, X_m, "x [mm]", but not in
   x_velocity. Its numbers are converted to the unit that is asked for: "size_mm" reads size_um, "x" reads metres. A
   column without a unit is found only if none is asked for. */
#ifndef RIDDLE_CSV_H
#define RIDDLE_CSV_H

#include <stddef.h>

#include "progress.h"

/* A column is of text if its first cell that is not empty is no number; its values are NaN. An empty cell is NaN. */
typedef struct csv_data {
    int rows, columns;
    char **names;           /* [columns] */
    double *values;         /* [rows][columns], as they stood */
    char **cells;           /* [rows][columns], without blanks around */
    int *lines;             /* [rows] of the file, from 1 */
    unsigned char *is_text; /* [columns] */
    char *memory;           /* everything else points into here */
} csv_data;

/* 0, or -1 with one line "file:12: column x: 'abc' is not a number" in message; *data is then empty. Free
   with csv_free. */
int csv_read(const char *path, csv_data *data, char *message, int message_size);
/* The same from memory. */
int csv_parse(const char *text, long size, const char *path, csv_data *data, char *message, int message_size);
/* Is `name` of a file what is asked for as `wanted`? 1, and the factor; 0; -1 if its unit cannot be converted. */
int csv_is(const char *name, const char *wanted, double *factor);
/* Its index; factor (may be NULL): by which its numbers are multiplied. -1 if it is not there, if two columns have the
   name, or if its unit cannot be converted; message (may be NULL) then says so and lists the columns that are there. */
int csv_find(const csv_data *data, const char *name, double *factor, char *message, int message_size);
/* 1: its unit is one of the dimension ('L' length, 'v' velocity, 'w' spin, 's' share, '#' number without unit), or it
   has no unit. */
int csv_measures(const char *name, char dimension);
/* 0: there is no unit of this name. Letters may be of any case but where it tells two units apart: mPa and MPa, mg and
   Mg, ml and Ml. Of MPA the dimension is '?'. */
int csv_unit(const char *name, char *dimension, double *si);
/* A plain letter as a small one, whatever the locale. */
char csv_small(char c);
/* Where the quotes around a cell end, before one of these characters or the end of the text: the place of the closing
   quote from the cell's beginning on; 0: the cell has none around it. Doubled quotes within close nothing. */
size_t csv_quoted(const char *cell, const char *stops);
/* Cuts a line (ended by 0) at its separators into cells without blanks and quotes around; returns how many. Doubled
   quotes in a quoted cell become one. */
int csv_cut(char *line, char separator, char **cells);
int csv_column(const csv_data *data, const char *name); /* its index, or -1 */
/* In the unit asked for; NaN if there is no such cell. */
double csv_value(const csv_data *data, int row, const char *name);
void csv_free(csv_data *data);

#endif
