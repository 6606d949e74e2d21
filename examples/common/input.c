#define _POSIX_C_SOURCE 200809L
#include "input.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static char *too_large(const char *path, int most_mb, char *message, size_t message_size) {
    snprintf(message, message_size, "%s: more than %d MB", path, most_mb);
    return NULL;
}

static char *read_all(const char *path, FILE *file, int most_mb, size_t *size, char *message, size_t message_size) {
    char *bytes = NULL;
    size_t capacity = 0;
    int error = file ? 0 : errno;
    const size_t most = most_mb ? (size_t)most_mb * 1000000u : (size_t)-1;
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
        if (*size > most) {
            free(bytes);
            return too_large(path, most_mb, message, message_size);
        }
    }
    if (!error) {
        bytes[*size] = '\0';
        return bytes;
    }
    snprintf(message, message_size, "%s: %s", path, strerror(error));
    free(bytes);
    return NULL;
}

char *input_read_most(const char *path, int most_mb, size_t *size, char *message, size_t message_size) {
    FILE *file = fopen(path, "rb");
    struct stat about;
    const int stream = file && fstat(fileno(file), &about) == 0 && !S_ISREG(about.st_mode);
    if (stream && (most_mb == 0 || most_mb > INPUT_STREAM_MB)) most_mb = INPUT_STREAM_MB;
    char *bytes = read_all(path, file, most_mb, size, message, message_size);
    if (file) fclose(file);
    return bytes;
}

char *input_read(const char *path, size_t *size, char *message, size_t message_size) {
    return input_read_most(path, 0, size, message, message_size);
}
