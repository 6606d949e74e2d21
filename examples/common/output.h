/* output.h: folders, and files that are whole or absent. A file is written under a temporary name in the same folder, every write is
   checked, and close renames it; if anything failed, or the program leaves early, the temporary file is removed and an older
   file of that name stays. */
#ifndef RIDDLE_OUTPUT_H
#define RIDDLE_OUTPUT_H

#include <stddef.h>

#include "progress.h"

typedef struct output output;

/* folder may be NULL: name is then a whole path. A device (/dev/full), a pipe and "-" (standard output) are written directly.
   NULL after an error, which has been printed. */
output *output_open(const char *folder, const char *name);
int output_print(output *file, const char *format, ...) COMMON_PRINTF(2, 3);
int output_write(output *file, const void *bytes, size_t size);
int output_close(output *file);    /* 0: the file stands under its name. -1: one line was printed, nothing is left */
void output_discard(output *file); /* nothing is left */

/* Makes a folder and its parents, and tries that it can be written to. 0, or -1 with the reason in message. */
int output_make_folder(const char *path, char *message, size_t size);
/* Whether a file of that name could be written now. 0, or -1 with the reason in message. */
int output_can_write(const char *path, char *message, size_t size);
/* "folder/name" in buffer; returns buffer. folder may be NULL. */
const char *output_path(char *buffer, size_t size, const char *folder, const char *name);
/* A file or folder that comes with the repository: name if it exists from where the program is run, else name in the repository's root. */
const char *output_find(char *buffer, size_t size, const char *name);

#endif
