/* sheet.h: tables from a laboratory as people write them, for every program that reads one.

   Cells are separated by tabs, semicolons, commas or blanks; numbers have decimal points or commas, thousands apart by
   a blank, an apostrophe or the other mark; cells may have quotes and units ("63 um", "12,5 %"). The text is UTF-8,
   UTF-16 or Latin-1. Lines before the heading, comments (#), empty lines, a line "sep=;", separators at the end of a
   line and a row "total" are passed over. The heading is the first line in which all needed columns are found, alone or
   together with the line below it.

   A heading is words and a unit: "Size [mm]", "size_mm", "Siebweite in mm", "Zeit t / s". The words that name a column
   are in sheet_words.h, in English and German. A column with a word that is unknown is not read; a column that is
   needed and is not there is refused in one line that lists the columns that are. Without a unit numbers are SI;
   amounts of sieves that exceed 1.5 are in per cent.

   Sizes (sheet_read_sizes): sieves in any order, by their width, by phi, or by mesh number (ASTM E11 or Tyler); classes
   ("63-125", "< 63", or two columns low and high); amounts as what passes, what is coarser, what is on each sieve
   (share or mass, also gross and tare), with or without a pan. What comes out is what passes each size. */
#ifndef RIDDLE_SHEET_H
#define RIDDLE_SHEET_H

#include <stdbool.h>

enum { SHEET_COLUMNS = 64, SHEET_HOW = 700, SHEET_AMOUNTS = 8 };

/* A column that a program reads. */
typedef struct sheet_column {
    const char *name;    /* a row of the words in sheet_words.h */
    char dimension;      /* as in csv.h: 'L' 'T' 'M' 'V' 'P' 'W' 'v' 'f' 'a'; 's' share; '%' a share that is in per cent
                             where one exceeds 1.5; '#' number; 't' text, any cell */
    bool needed;         /* else it may be missing */
    const double *value; /* out: [rows] in SI, NaN for an empty cell and for text; NULL: the column is not there */
    const char *heading; /* out: as it stood */
    int index;           /* out: of the file's columns; -1: not there */
    double factor;       /* out: by which numbers of cells without a unit of their own are multiplied */
} sheet_column;

static inline sheet_column sheet_want(const char *name, char dimension, bool needed) {
    sheet_column column = {name, dimension, needed, 0, 0, -1, 1.0};
    return column;
}

typedef struct sheet {
    int rows, columns;
    const char *const *cell; /* [rows][columns], as they stood; "" where a row ends before */
    const int *line;         /* [rows] of the file, from 1 */
    char how[SHEET_HOW];     /* how it was read, for the user: "FILE: decimal commas; time from 'Zeit [s]' 0
                                ... 600 s, ..." */
    void *memory[4];
} sheet;

/* 0, or -1 with one line in message that begins with the path; the sheet is then empty. Free with sheet_free. */
int sheet_read(const char *path, sheet_column *columns, int n, sheet *out, char *message, int message_size);
int sheet_parse(const char *bytes, long size, const char *path, sheet_column *columns, int n, sheet *out, char *message,
                int message_size);
void sheet_free(sheet *s);

/* Sieves or classes by size, the finest first. */
typedef struct sheet_sizes {
    int n;                         /* sizes */
    bool single;                   /* shares of grains of one size each, as of "size,share": no curve */
    int by_number;                 /* 1: shares of number, 0: of mass or volume, -1: the heading does not say */
    double *size;                  /* [n] [m], above 0 */
    double *amount[SHEET_AMOUNTS]; /* [n] share that passes the size; single: share of the size; of a name that ends
                                      with _sd: deviation of the share between this size and the one below, NaN where
                                      none is given. NULL: the column is not there */
    double *above;                 /* [1 a name] share coarser than the last size */
    int *line;                     /* [n] of the file */
    char how[SHEET_HOW];
    void *memory;
} sheet_sizes;

/* Amounts by name, such as "feed", "coarse", "coarse_sd" (which may be missing); or names NULL: the only
   amount there is. */
int sheet_read_sizes(const char *path, const char *const *names, int n, sheet_sizes *out, char *message,
                     int message_size);
int sheet_parse_sizes(const char *bytes, long size, const char *path, const char *const *names, int n, sheet_sizes *out,
                      char *message, int message_size);
void sheet_free_sizes(sheet_sizes *s);

#endif
