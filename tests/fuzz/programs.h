/* programs.h: random programs of a header's public calls. A target draws its calls from bytes (libFuzzer, AFL, a file)
   or from a seed, and asserts what must hold whatever they are. It defines

       static uint64_t run_program(fuzz_draws *draws);      // a number that depends on every bit of the results

   and ends with FUZZ_PROGRAMS(count, other, seeds...); other: the first seed of another kind of programs, and half the
   first of a third one, or 0; seeds: of programs that have found something, which is mended. As a plain program:

       fuzz_dem                 `count` seeds of each kind, and `seeds`: the regression test
       fuzz_dem FIRST COUNT     seeds FIRST .. FIRST + COUNT - 1; prints one hash of all, the same with gcc and clang
                                and on every machine
       fuzz_dem FILE...         the programs that these bytes spell

   With FUZZ_HASHES set it prints the hash of each program, with FUZZ_TRACE each call and what it answered.

   With clang and libFuzzer: see fuzz.h. */
#ifndef RIDDLE_FUZZ_PROGRAMS_H
#define RIDDLE_FUZZ_PROGRAMS_H

#include "fuzz.h"

#include <float.h>
#include <math.h>

/* Where a program comes from: bytes while there are any, else a generator (splitmix64). */
typedef struct fuzz_draws {
    const uint8_t *bytes;
    size_t left;
    uint64_t state;
} fuzz_draws;

static uint64_t fuzz_bits(fuzz_draws *d) {
    uint64_t z = d->state += 0x9e3779b97f4a7c15u;
    if (d->left >= 2) { /* two bytes decide, the rest follows from them */
        z = (uint64_t)d->bytes[0] << 8 | d->bytes[1];
        d->bytes += 2, d->left -= 2;
        return z << 48 | z << 32 | z << 16 | z;
    }
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}
static double fuzz_uniform(fuzz_draws *d) { return (double)(fuzz_bits(d) >> 11) * 0x1p-53; }
static int fuzz_one_of(fuzz_draws *d, int n) { return (int)(fuzz_uniform(d) * n); }

/* Numbers that callers get wrong. */
static const double fuzz_hostile[] = {NAN,    INFINITY, -INFINITY, DBL_MAX, -DBL_MAX, 1e200,       -1e200, 1e80,
                                      -1e30,  1e30,     1e10,      DBL_MIN, 5e-324,   -5e-324,     1e-200, 1e-30,
                                      1e-300, -1.0,     0.0,       1.0,     -0.0,     2147483648.0};
static double fuzz_hostile_number(fuzz_draws *d) {
    return fuzz_hostile[fuzz_one_of(d, (int)(sizeof fuzz_hostile / sizeof *fuzz_hostile))];
}

/* FNV-1a over the bits of a number; NaN is one number. */
static void fuzz_mix_bits(uint64_t *hash, uint64_t bits) {
    for (int k = 0; k < 8; k++) *hash = (*hash ^ (bits >> (8 * k) & 255u)) * 0x100000001b3u;
}
static void fuzz_mix_number(uint64_t *hash, double v) {
    uint64_t bits = 0x7ff8000000000000u;
    if (!isnan(v)) memcpy(&bits, &v, sizeof bits);
    fuzz_mix_bits(hash, bits);
}

static uint64_t run_program(fuzz_draws *draws);
static uint64_t fuzz_seed; /* of the program under way, to be named when it fails */
static int fuzz_traces;    /* tell each call and its answer? */

static uint64_t fuzz_run_seed(uint64_t seed) {
    fuzz_draws d = {NULL, 0, seed * 0xd1342543de82ef95u + 1};
    fuzz_seed = seed;
    return run_program(&d);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    fuzz_draws d = {bytes, size, 1};
    run_program(&d);
    return 0;
}

#define FUZZ_HOLDS(condition)                                                                                          \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: seed %llu: %s\n", __FILE__, __LINE__, (unsigned long long)fuzz_seed, #condition);  \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

#ifdef FUZZ_LIBRARY
#define FUZZ_PROGRAMS(...)
#else
static int fuzz_programs_main(int argc, char **argv, const uint64_t *seeds, size_t n) {
    uint64_t first = 0, count = seeds[0], hash = 0xcbf29ce484222325u;
    static const char *const none[] = {""};
    if (argc > 1 && strspn(argv[1], "0123456789") != strlen(argv[1])) return fuzz_main(argc, argv, none, 1, 0);
    if (argc > 2) first = strtoull(argv[1], NULL, 10), count = strtoull(argv[2], NULL, 10);
    const int tells = getenv("FUZZ_HASHES") != NULL; /* to find the first that differs */
    fuzz_traces = getenv("FUZZ_TRACE") != NULL;
    for (uint64_t k = first; k < first + count; k++) {
        const uint64_t of = fuzz_run_seed(k);
        fuzz_mix_bits(&hash, of);
        if (tells) printf("%llu %016llx\n", (unsigned long long)k, (unsigned long long)of);
    }
    for (uint64_t k = 0; argc < 2 && seeds[1] > 0 && k < 2 * count; k++)
        fuzz_run_seed((1 + k / count) * seeds[1] + k % count);
    for (size_t k = 2; argc < 2 && k < n; k++) fuzz_run_seed(seeds[k]);
    printf("%llu programs from seed %llu: hash %016llx\n[  PASSED  ] 1 test(s).\n", (unsigned long long)count,
           (unsigned long long)first, (unsigned long long)hash);
    return 0;
}
#define FUZZ_PROGRAMS(...)                                                                                             \
    int main(int argc, char **argv) {                                                                                  \
        static const uint64_t seeds[] = {__VA_ARGS__};                                                                 \
        return fuzz_programs_main(argc, argv, seeds, sizeof seeds / sizeof *seeds);                                    \
    }
#endif

#endif
