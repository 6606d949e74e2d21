/* progress.h: what a program tells while it runs, Ctrl-C, and its exit status. */
#ifndef RIDDLE_PROGRESS_H
#define RIDDLE_PROGRESS_H

#include <stdbool.h>

#ifndef RIDDLE_IO_API
#define RIDDLE_IO_API extern /* the one copy of the bodies is in io.c */
#endif
#include "riddle_io.h"

#if defined(__GNUC__)
#define COMMON_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define COMMON_PRINTF(text, first)
#endif

/* True once Ctrl-C (SIGINT), SIGTERM or SIGHUP has come, or who reads the output has gone (SIGPIPE): leave loops,
   write nothing that is not whole, and return common_exit_status().
   A second Ctrl-C ends the program at once. Costs one load; call it from any thread. */
bool common_interrupted(void);
/* Ctrl-C ends the program at once: during work that cannot be stopped in its middle and that has no file open. */
void common_interrupt_at_once(bool at_once);

/* 128 + the signal that ended the run (130 after Ctrl-C), 1 if anything failed, else 0. Says "interrupted" on stderr in
   the first case. */
int common_exit_status(void);

/* Prints on stdout unless --quiet. */
void common_print(const char *format, ...) COMMON_PRINTF(1, 2);

/* Prints "<program>: ..." as one line on stderr and marks the run as failed: common_exit_status() is
   then 1. Returns -1. */
int common_fail(const char *format, ...) COMMON_PRINTF(1, 2);

/* The bar of riddle_io.h, that several threads may share; nothing when --quiet. */
typedef struct riddle_io_progress progress;

void progress_begin(progress *bar, const char *what, double total);
void progress_update(progress *bar, double done); /* cheap: at most 10 prints a second; one clock read each */
void progress_add(progress *bar, double more);
void progress_end(progress *bar); /* clears the bar, prints "what: done in 3.2 s" */

/* Called by program_start. The first: standard streams that were closed are opened on nothing, so that no file of the
   run takes the place of one. */
void common_open_standard_streams(void);
void common_set_quiet(bool quiet);
void common_set_name(const char *name);
void common_catch_interrupt(void);
bool common_quiet(void);

#endif
