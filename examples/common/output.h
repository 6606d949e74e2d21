/* output.h: riddle_io.h and riddle_plot.h with the programs' way of telling an error: one line on stderr, and the run
   is marked as failed (progress.h). A program of your own needs those two alone. */
#ifndef RIDDLE_COMMON_OUTPUT_H
#define RIDDLE_COMMON_OUTPUT_H

#ifndef RIDDLE_IO_API
#define RIDDLE_IO_API extern /* the one copy of the bodies is in output.c */
#define RIDDLE_PLOT_API extern
#endif
#include "riddle_io.h"
#include "riddle_plot.h"

#include "progress.h"

/* A file or folder that comes with the repository: name if it exists from where the program is run, else name in the
   repository's root. */
const char *output_find(char *buffer, size_t size, const char *name);

/* Holds a folder against a second program that writes the same files, until this one ends, however it does. 0, also
   where the system cannot; -1: another program holds it. */
int output_hold_folder(const char *folder);

/* A CSV file; its rows: riddle_io_row. header: "time_s,retained_small". A '#' comment line may stand before it:
   "# a comment\ntime_s,...". NULL after an error. */
riddle_io_file *csv_open(const char *folder, const char *name, const char *header);
int csv_line(riddle_io_file *c, const char *format, ...) COMMON_PRINTF(2, 3); /* a row by hand, without the newline */

/* Says that a figure shows nothing of this run, and why: "spheres.svg is left out: no sphere has reached the cloth".
   Removes one that an earlier run has left in the folder. */
void figure_left_out(const char *folder, const char *name, const char *why);

void table_end(riddle_io_table *t); /* on stdout; nothing when --quiet */

#endif
