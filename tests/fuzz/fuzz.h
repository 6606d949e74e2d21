/* fuzz.h: a fuzz target is one function LLVMFuzzerTestOneInput(bytes, size). With clang and libFuzzer:

       clang -g -fsanitize=fuzzer,address,undefined -DFUZZ_LIBRARY -Iexamples/common tests/fuzz/fuzz_csv.c \
           examples/common/[a-z]*.c -lm -lpthread

   Without, this header adds a main that runs it over files named on the command line, or over inputs mixed from the
   target's own samples: that is the regression test. Crashes and sanitizers are the judges, and whatever the
   target asserts. */
#ifndef RIDDLE_FUZZ_H
#define RIDDLE_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

#define FUZZ_ASSERT(condition)                                                                                         \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);                                            \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

#ifdef FUZZ_LIBRARY
#define FUZZ_MAIN(samples, n, runs)
#else
#define FUZZ_MAIN(samples, n, runs)                                                                                    \
    int main(int argc, char **argv) { return fuzz_main(argc, argv, samples, n, runs); }

static uint32_t fuzz_random(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(*state >> 33);
}

/* A sample with some bytes changed, cut out, or another sample's piece put in. */
static size_t fuzz_mix(uint64_t *state, const char *const *samples, int n, uint8_t *bytes, size_t capacity) {
    const char *sample = samples[fuzz_random(state) % (uint32_t)n];
    size_t size = strlen(sample) < capacity ? strlen(sample) : capacity;
    memcpy(bytes, sample, size);
    for (uint32_t changes = fuzz_random(state) % 6; changes > 0 && size > 0; changes--) {
        size_t at = fuzz_random(state) % size;
        switch (fuzz_random(state) % 4) {
        case 0: bytes[at] = (uint8_t)fuzz_random(state); break;
        case 1: bytes[at] = (uint8_t) ",\n\r\"#- =.e0"[fuzz_random(state) % 11]; break;
        case 2: size = at; break;
        default: {
            const char *other = samples[fuzz_random(state) % (uint32_t)n];
            size_t from = strlen(other) ? fuzz_random(state) % strlen(other) : 0, length = strlen(other) - from;
            if (at + length > capacity) length = capacity - at;
            memcpy(bytes + at, other + from, length);
            if (at + length > size) size = at + length;
        }
        }
    }
    return size;
}

static int fuzz_main(int argc, char **argv, const char *const *samples, int n, int runs) {
    static uint8_t bytes[1 << 16];
    for (int i = 1; i < argc; i++) {
        FILE *f = fopen(argv[i], "rb");
        if (!f) return 2;
        size_t size = fread(bytes, 1, sizeof bytes, f);
        fclose(f);
        LLVMFuzzerTestOneInput(bytes, size);
    }
    uint64_t state = 1;
    for (int i = 0; argc == 1 && i < runs; i++) {
        size_t size = fuzz_mix(&state, samples, n, bytes, sizeof bytes);
        uint8_t *exact = (uint8_t *)malloc(size + 1); /* so that a byte too far is noticed */
        if (!exact) return 1;
        memcpy(exact, bytes, size);
        LLVMFuzzerTestOneInput(exact, size);
        free(exact);
    }
    printf("[  PASSED  ] 1 test(s).\n");
    return 0;
}
#endif

#endif
