/* json.h: one JSON object, written as it comes. Numbers keep every bit (%.17g), a number that is not finite
   becomes null. */
#ifndef RIDDLE_JSON_H
#define RIDDLE_JSON_H

#include <stdbool.h>

#include "options.h"

typedef struct json json;

/* Begins the object. path NULL: returns NULL, and every call below does nothing. */
json *json_open(const char *path);
int json_close(json *j); /* ends the object; 0, or else one line was printed on stderr */
void json_discard(json *j);

/* Keys carry the SI unit: "wall_s". key is NULL inside an array. */
void json_number(json *j, const char *key, double value);
void json_integer(json *j, const char *key, long long value);
void json_bool(json *j, const char *key, bool value);
void json_string(json *j, const char *key, const char *value); /* NULL: null */
void json_array(json *j, const char *key, const double *values, int n);
void json_integers(json *j, const char *key, const int *values, int n);
void json_object_begin(json *j, const char *key);
void json_object_end(json *j);
void json_array_begin(json *j, const char *key);
void json_array_end(json *j);

/* program, threads, seed, quick, wall_s (since the start), peak_memory_bytes, compiler */
void json_program(json *j, const program *self);

#endif
