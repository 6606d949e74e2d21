/* libc.c: the bodies. Memory: blocks of powers of two, each size with a list of its free ones; the machine gives more
   by pages of 64 kB. */
#include <stdint.h>

#include "math.h"
#include "stdlib.h"
#include "string.h"

double fmin(double a, double b) { return a != a ? b : b != b ? a : a < b || (a == b && __builtin_signbit(a)) ? a : b; }
double fmax(double a, double b) { return a != a ? b : b != b ? a : a > b || (a == b && !__builtin_signbit(a)) ? a : b; }

typedef union number {
    double value;
    uint64_t bits;
} number;

double ldexp(double x, int exponent) {
    number two;
    for (; exponent > 1023; exponent -= 1023) {
        x *= 0x1p1023;
        if (exponent > 4000) exponent = 4000;
    }
    for (; exponent < -1022; exponent += 969) { /* 1022 - 53: one rounding only, at the end */
        x *= 0x1p-969;
        if (exponent < -4000) exponent = -4000;
    }
    two.bits = (uint64_t)(1023 + exponent) << 52;
    return x * two.value;
}

double frexp(double x, int *exponent) {
    number n;
    n.value = x;
    int e = (int)(n.bits >> 52 & 2047);
    *exponent = 0;
    if (x == 0.0 || e == 2047) return x;
    if (e == 0) { /* subnormal */
        n.value = x * 0x1p64;
        e = (int)(n.bits >> 52 & 2047) - 64;
    }
    *exponent = e - 1022;
    n.bits = (n.bits & ~((uint64_t)2047 << 52)) | (uint64_t)1022 << 52;
    return n.value;
}

void *memcpy(void *to, const void *from, size_t n) { return __builtin_memmove(to, from, n); } /* memory.copy */
void *memmove(void *to, const void *from, size_t n) { return __builtin_memmove(to, from, n); }
void *memset(void *to, int byte, size_t n) { return __builtin_memset(to, byte, n); }
int memcmp(const void *a, const void *b, size_t n) {
    const unsigned char *p = a, *q = b;
    for (size_t k = 0; k < n; k++)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}
size_t strlen(const char *s) {
    size_t n = 0;
    while (s[n]) n++;
    return n;
}
int strcmp(const char *a, const char *b) {
    while (*a && *a == *b) a++, b++;
    return (unsigned char)*a - (unsigned char)*b;
}

enum { HEAD = 16, ORDERS = 32, PAGE = 65536 };
extern unsigned char __heap_base; /* the linker's: first byte that nothing uses */
typedef struct block {
    size_t order;
    struct block *next;
} block;
static block *spare[ORDERS];
static size_t top;

static block *carve(size_t size) {
    if (!top) top = ((size_t)&__heap_base + HEAD - 1) / HEAD * HEAD;
    const size_t end = top + size, have = __builtin_wasm_memory_size(0) * (size_t)PAGE;
    if (end < top) return NULL;
    if (end > have && __builtin_wasm_memory_grow(0, (end - have + PAGE - 1) / PAGE) == (size_t)-1) return NULL;
    block *b = (block *)top;
    top = end;
    return b;
}

void *malloc(size_t size) {
    size_t order = 5;
    while (order < ORDERS && ((size_t)1 << order) < size + HEAD) order++;
    if (order >= ORDERS - 1) return NULL;
    block *b = spare[order];
    if (b) spare[order] = b->next;
    else b = carve((size_t)1 << order);
    if (!b) return NULL;
    b->order = order;
    return (unsigned char *)b + HEAD;
}

void free(void *old) {
    if (!old) return;
    block *b = (block *)((unsigned char *)old - HEAD);
    b->next = spare[b->order];
    spare[b->order] = b;
}

void *calloc(size_t n, size_t size) {
    if (size && n > (size_t)-1 / size) return NULL;
    void *made = malloc(n * size);
    return made ? memset(made, 0, n * size) : NULL;
}

void *realloc(void *old, size_t size) {
    if (!old) return malloc(size);
    const size_t room = ((size_t)1 << ((block *)((unsigned char *)old - HEAD))->order) - HEAD;
    if (size <= room) return old;
    void *made = malloc(size);
    if (made) memcpy(made, old, room), free(old);
    return made;
}
