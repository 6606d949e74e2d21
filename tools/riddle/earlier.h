/* earlier.h: files of an earlier run in the folder of this one. Only those are removed whose name and beginning are
   those of what riddle run writes. */
#ifndef RIDDLE_EARLIER_H
#define RIDDLE_EARLIER_H

/* One that this run does not write; text: what it begins with, or NULL: anything. */
void earlier_remove(const char *folder, const char *name, const char *text);
/* Of a run that begins: series, their frames, tables of particles, movies. */
void earlier_remove_series(const char *folder);

#endif
