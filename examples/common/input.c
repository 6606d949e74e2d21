#include "input.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

char *input_read(const char *path, size_t *size, char *message, size_t message_size) {
    FILE *file = fopen(path, "rb");
    char *bytes = NULL;
    size_t capacity = 0;
    int error = file ? 0 : errno;
    *size = 0;
    while (file && !error) {
        if (*size + 1 >= capacity) {
            capacity = capacity ? 2 * capacity : 65536;
            char *larger = realloc(bytes, capacity);
            if (!larger) error = ENOMEM;
            else bytes = larger;
            if (error) break;
        }
        const size_t got = fread(bytes + *size, 1, capacity - 1 - *size, file);
        if (got == 0) {
            error = ferror(file) ? errno : 0;
            break;
        }
        *size += got;
    }
    if (file) fclose(file);
    if (!error) {
        bytes[*size] = '\0';
        return bytes;
    }
    snprintf(message, message_size, "%s: %s", path, strerror(error));
    free(bytes);
    return NULL;
}
