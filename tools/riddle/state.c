/* state.c: see state.h */
#include "state.h"

#include <stdlib.h>
#include <string.h>

static const char magic[16] = "riddle scene 5\n";
const char state_head[] = "riddle scene ";

/* Fowler, Noll & Vo's hash, 64 bits. */
uint64_t state_checksum(const void *start, size_t size) {
    const unsigned char *bytes = start;
    uint64_t h = 14695981039346656037u;
    for (size_t k = 0; k < size; k++) h = (h ^ bytes[k]) * 1099511628211u;
    return h;
}

void state_bytes(scene_state *io, void *bytes, size_t size) {
    if (io->failed || size == 0) return;
    if (io->reading) {
        if (io->size - io->at < size) {
            io->failed = 1;
            memset(bytes, 0, size);
            return;
        }
        memcpy(bytes, io->bytes + io->at, size);
        io->at += size;
        return;
    }
    if (io->room - io->size < size) {
        const size_t room = 2 * io->room + size + 4096;
        unsigned char *more = realloc(io->bytes, room);
        if (!more) {
            io->failed = 1;
            return;
        }
        io->bytes = more, io->room = room;
    }
    memcpy(io->bytes + io->size, bytes, size);
    io->size += size;
}

void state_whole(scene_state *io, uint64_t *value) {
    unsigned char b[8] = {0};
    for (int k = 0; k < 8; k++) b[k] = (unsigned char)(*value >> (8 * k));
    state_bytes(io, b, 8);
    *value = 0;
    for (int k = 0; k < 8; k++) *value |= (uint64_t)b[k] << (8 * k);
}

void state_numbers(scene_state *io, double *values, size_t n) {
    for (size_t k = 0; k < n && !io->failed; k++) {
        uint64_t bits;
        memcpy(&bits, &values[k], sizeof bits);
        state_whole(io, &bits);
        memcpy(&values[k], &bits, sizeof bits);
    }
}

void state_same(scene_state *io, double value) {
    double other = value;
    state_numbers(io, &other, 1);
    if (other != value) io->failed = 1;
}

void state_begin_writing(scene_state *io) {
    char head[sizeof magic];
    memset(io, 0, sizeof *io);
    memcpy(head, magic, sizeof head);
    state_bytes(io, head, sizeof head);
}

int state_begin_reading(scene_state *io, unsigned char *bytes, size_t size) {
    memset(io, 0, sizeof *io);
    io->reading = 1, io->bytes = bytes;
    if (size < sizeof magic + 8 || memcmp(bytes, state_head, sizeof state_head - 1) != 0) return -1;
    if (memcmp(bytes, magic, sizeof magic) != 0) return 1;
    io->size = size - 8, io->at = io->size;
    scene_state tail = *io;
    uint64_t sum;
    tail.size = size;
    state_whole(&tail, &sum);
    io->at = sizeof magic;
    return sum == state_checksum(bytes, io->size) ? 0 : -1;
}

int state_finish(scene_state *io) {
    uint64_t sum = io->failed ? 0 : state_checksum(io->bytes, io->size);
    if (io->reading) io->failed |= io->at != io->size;
    else state_whole(io, &sum);
    return io->failed ? -1 : 0;
}

void state_free(scene_state *io) {
    free(io->bytes);
    memset(io, 0, sizeof *io);
}
