/* csv.h: tables of numbers from files. Lines that begin with '#' are comments, the first other line names the columns. */
#ifndef RIDDLE_CSV_H
#define RIDDLE_CSV_H

#include "progress.h"

/* A column is of text if its first cell that is not empty is no number; its values are NaN. An empty cell is NaN. */
typedef struct csv_data {
    int rows, columns;
    char **names;   /* [columns] */
    double *values; /* [rows][columns] */
    char **cells;   /* [rows][columns], as they stood, without blanks around */
    char *memory;   /* everything else points into here */
} csv_data;

/* 0, or -1 with one line "file:12: column x: 'abc' is not a number" in message; *data is then empty. Free with csv_free. */
int csv_read(const char *path, csv_data *data, char *message, int message_size);
int csv_parse(const char *text, long size, const char *path, csv_data *data, char *message, int message_size); /* the same from memory */
int csv_column(const csv_data *data, const char *name);                                                        /* its index, or -1 */
double csv_value(const csv_data *data, int row, const char *name); /* NaN if there is no such cell */
void csv_free(csv_data *data);

#endif
