/* state.h: numbers and bytes to and from a save, by the same calls, so that what is written is what is read.
   Little-endian, with a checksum. */
#ifndef RIDDLE_STATE_H
#define RIDDLE_STATE_H

#include <stddef.h>
#include <stdint.h>

typedef struct scene_state {
    int reading, failed;
    unsigned char *bytes;
    size_t size, at, room;
} scene_state;

uint64_t state_checksum(const void *bytes, size_t size);
/* What a save of any version begins with. */
extern const char state_head[14];
void state_begin_writing(scene_state *io);
/* 0; -1: no whole save; 1: one of another version. bytes become the state's. */
int state_begin_reading(scene_state *io, unsigned char *bytes, size_t size);
int state_finish(scene_state *io); /* writing: appends the checksum. -1: something failed */
void state_free(scene_state *io);

void state_numbers(scene_state *io, double *values, size_t n);
void state_whole(scene_state *io, uint64_t *value);
void state_same(scene_state *io, double value); /* a number that must be as it was, or the save is of another scene */
void state_bytes(scene_state *io, void *bytes, size_t size);

#endif
