/* input.h: whole files into memory. */
#ifndef RIDDLE_INPUT_H
#define RIDDLE_INPUT_H

#include <stddef.h>

enum { INPUT_STREAM_MB = 256 }; /* at most, of what is no file of a disk: a device may never end */

/* The bytes of a file, and a 0 after them; free with free(). NULL with one line "file: what is wrong" in message. */
char *input_read(const char *path, size_t *size, char *message, size_t message_size);
/* The same of a file of at most so many MB. */
char *input_read_most(const char *path, int most_mb, size_t *size, char *message, size_t message_size);

#endif
