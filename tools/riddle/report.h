/* report.h: what a run of a scene leaves: rows of measured.csv, frames, pictures, curves, the conditions to stop. */
#ifndef RIDDLE_REPORT_H
#define RIDDLE_REPORT_H

#include "scene.h"

typedef struct report report;

/* NULL with the message in the file: a stop condition names no column. */
report *report_open(scene *s, const char *folder, const int size[2]); /* of pictures [pixels] */
/* Before a run that is no continued one: removes the frames, tables and movies of an earlier run. */
void report_begin(const report *r);
/* To be called between two ticks: measures, writes frames. The condition that ends the run, or NULL. */
const stop_def *report_look(report *r);
double report_overlap(const report *r); /* the largest of all rows, over a diameter */
/* The same at the end of the run: measures there at all events. A save must be before it. */
const stop_def *report_end(report *r);
/* CSV, curves, picture. What it has written: "measured.csv, curves.svg, scene.png"; after a printed line less. What it
   does not write and an earlier run has left is removed. */
const char *report_write(report *r);
void report_write_so_far(report *r); /* measured.csv and curves.svg of the rows up to here */
void report_json(const report *r, json *j);
void report_say(const report *r); /* prints the results that one asks for */
int report_exchange(report *r, scene_state *io);
void report_free(report *r);

#endif
