/* scene_results.h: the numbers that one simulates for, at the end of a run: results.csv, separation.csv, partition.svg, JSON. */
#ifndef RIDDLE_SCENE_RESULTS_H
#define RIDDLE_SCENE_RESULTS_H

#include "rows.h"

/* Writes the files; `wrote` gets the name of each that is there. */
void scene_results_write(const row_table *r, const char *folder, void (*wrote)(void *user, const char *name), void *user);
void scene_results_json(const row_table *r, json *j); /* "results" and, with a separation, "separation" */
void scene_results_say(const row_table *r);           /* a line for a separation, and one for each heap */

#endif
