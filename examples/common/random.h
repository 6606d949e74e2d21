/* random.h: random numbers of programs and tests, the same ones everywhere. state: any number; each call
   moves it on. */
#ifndef RIDDLE_RANDOM_H
#define RIDDLE_RANDOM_H

#include <stdint.h>

/* splitmix64 (Steele, Lea & Flood 2014) */
static inline uint64_t random_bits(uint64_t *state) {
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}
/* 0 <= x < 1 */
static inline double random_share(uint64_t *state) { return (double)(random_bits(state) >> 11) * 0x1p-53; }
/* 0 < x < 1 */
static inline double random_inner(uint64_t *state) { return ((double)(random_bits(state) >> 11) + 0.5) * 0x1p-53; }

/* Knuth's linear congruential generator of 64 bits, whose upper bits are random: 0 <= x < 1 */
static inline double random_plain(uint64_t *state) {
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*state >> 11) * 0x1p-53;
}

/* About normal with mean 0 and deviation 1: the sum of twelve. */
static inline double random_bell(uint64_t *state) {
    double sum = -6.0;
    for (int k = 0; k < 12; k++) sum += random_plain(state);
    return sum;
}

#endif
