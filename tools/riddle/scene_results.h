/* scene_results.h: the numbers that one simulates for, at the end of a run: results.csv, separation.csv,
   partition.svg, JSON. */
#ifndef RIDDLE_SCENE_RESULTS_H
#define RIDDLE_SCENE_RESULTS_H

#include "rows.h"

typedef struct separation separation;

separation *scene_separation(const scene *s); /* at present; NULL if the scene measures none */
void scene_separation_free(separation *p);

/* Writes the files; `wrote` gets the name of each that is there. */
void scene_results_write(const row_table *r, const separation *p, const char *folder,
                         void (*wrote)(void *user, const char *name), void *user);
void scene_results_json(const row_table *r, const separation *p, json *j); /* "results", "separation" */
void scene_results_say(const row_table *r, const separation *p); /* a line for a separation, and one for each heap */

#endif
