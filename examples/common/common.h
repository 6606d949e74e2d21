/* common.h: what every Riddle program needs beside physics. One static library, no part of the headers.

   #include "common.h"

   int main(int argc, char **argv) {
       double time = 5.0;                                      // the default stands in the variable
       int    run = 5;
       option options[] = {
           option_int("case", "N", &run, 1, 15, "case of table 3"),
           option_positive("time", "S", &time, 1e4, "simulated time [s]"),
       };
       program self = program_start("batch_screening", "Dry batch screening.", options, 2, argc, argv);
       if (self.quick && !is_given(&self, "time")) time = 1.0;
       progress bar;
       progress_begin(&bar, "vibrating", time);
       for (double t = 0.0; t < time && !common_interrupted(); t += 0.01) progress_update(&bar, t);
       progress_end(&bar);
       // NULL when --json was not given: every json call then does nothing
       json *report = json_open(self.json);
       json_program(report, &self);
       json_number(report, "time_s", time);
       json_close(report);
       return common_exit_status();                            // 0, 1 if an output failed, 130 after Ctrl-C
   }

   output.h    riddle_io.h, all that is written     options.h  the command line     csv.h       tables from CSV
   progress.h  bar, Ctrl-C, exit status             json.h     one JSON object      particles.h spheres from CSV or .vtp
   machine.h   clock, memory, cores, jobs on threads                                render.h    pictures and movies of
               scenes
   random.h    random numbers
   results.h   tables of results: screen, CSV, JSON, figures
   sheet.h     tables of a laboratory: sieves, classes, readings
   Errors: a function that fails has printed one line on stderr and marked the run as failed; it returns -1 (or NULL),
   and every function takes the NULL that another returned and does nothing. A program that only ends with
   common_exit_status() is right. */
#ifndef RIDDLE_COMMON_H
#define RIDDLE_COMMON_H

#include "csv.h"
#include "input.h"
#include "output.h"
#include "json.h"
#include "machine.h"
#include "options.h"
#include "particles.h"
#include "progress.h"
#include "random.h"
#include "render.h"
#include "results.h"
#include "sheet.h"

#endif
