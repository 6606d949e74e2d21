/* lacks.h: what the programs call and a page lacks: other programs, for movies, and links of files. Included
   before each file. */
#ifndef RIDDLE_WASI_LACKS_H
#define RIDDLE_WASI_LACKS_H
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
static inline int lacks_system(const char *command) { return (void)command, 1; }
static inline FILE *lacks_popen(const char *command, const char *mode) { return (void)command, (void)mode, (FILE *)0; }
static inline int lacks_pclose(FILE *pipe) { return (void)pipe, 1; }
static inline char *lacks_realpath(const char *path, char *resolved) {
    const size_t size = strlen(path) + 1;
    char *copy = resolved ? resolved : (char *)malloc(size);
    return copy ? (char *)memcpy(copy, path, size) : copy;
}
#define system lacks_system
#define popen lacks_popen
#define pclose lacks_pclose
#define realpath lacks_realpath
#endif
