/* input.h: whole files into memory. */
#ifndef RIDDLE_INPUT_H
#define RIDDLE_INPUT_H

#include <stddef.h>

/* The bytes of a file, and a 0 after them; free with free(). NULL with one line "file: what is wrong" in message. */
char *input_read(const char *path, size_t *size, char *message, size_t message_size);

#endif
