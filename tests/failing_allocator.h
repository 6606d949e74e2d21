/* failing_allocator.h: a memory hook for tests that counts, can fail on order, and notices every misuse that a leak
   checker would.

       failing_allocator memory;
       // or failing_init_at(&memory, k): allocation k (from 0) and all later ones fail
       failing_init(&memory);
       x_def def = x_default_def();
       def.memory.fn = failing_fn;
       def.memory.user = &memory;
       ...
       assert_int_equal(failing_live(&memory), 0);

   To try every place where memory can run out:

       for (int k = 0; ; k++) {
           failing_init_at(&memory, k);
           status = everything(&memory);           // must return the out-of-memory status or ok, and free all
           assert_int_equal(failing_live(&memory), 0);
           if (!memory.has_failed) break;          // k was beyond the last allocation
       } */
#ifndef RIDDLE_FAILING_ALLOCATOR_H
#define RIDDLE_FAILING_ALLOCATOR_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct failing_allocator {
    int calls;       /* allocations and growths asked for */
    int fail_at;     /* the first of them that fails; negative: none */
    int fail_count;  /* how many fail from there on; negative: all */
    double chance;   /* of each one failing at random, 0 .. 1 */
    uint64_t random; /* state of that chance */
    int live;        /* blocks */
    size_t live_bytes, peak_bytes;
    int has_failed;
    int misused; /* wrong old size, or a damaged edge */
} failing_allocator;

static inline void failing_init(failing_allocator *a) {
    memset(a, 0, sizeof *a);
    a->fail_at = -1;
    a->fail_count = -1;
    a->random = 88172645463325252u;
}

static inline void failing_init_at(failing_allocator *a, int k) {
    failing_init(a);
    a->fail_at = k;
}

static inline int failing_refuses(failing_allocator *a) {
    int k = a->calls++,
        refuse = a->fail_at >= 0 && k >= a->fail_at && (a->fail_count < 0 || k < a->fail_at + a->fail_count);
    a->random ^= a->random << 13;
    a->random ^= a->random >> 7;
    a->random ^= a->random << 17;
    if (a->chance > 0.0 && (double)(a->random >> 11) * (1.0 / 9007199254740992.0) < a->chance) refuse = 1;
    if (refuse) a->has_failed = 1;
    return refuse;
}

/* Block: 64 bytes holding the size, the caller's bytes, 16 bytes that must not change. */
enum { FAILING_HEAD = 64, FAILING_TAIL = 16, FAILING_BYTE = 0xA5 };

static inline void *failing_fn(void *user, void *old, size_t old_size, size_t new_size) {
    failing_allocator *a = (failing_allocator *)user;
    unsigned char *block = old ? (unsigned char *)old - FAILING_HEAD : NULL;
    if (block) {
        size_t true_size;
        memcpy(&true_size, block, sizeof true_size);
        if (true_size != old_size) {
            a->misused = 1;
            fprintf(stderr, "memory hook: old size %lu given for a block of %lu\n", (unsigned long)old_size,
                    (unsigned long)true_size);
        }
        for (int i = 0; i < FAILING_TAIL; i++)
            if (block[FAILING_HEAD + true_size + (size_t)i] != FAILING_BYTE) a->misused = 1;
        old_size = true_size;
    } else if (old_size != 0) {
        a->misused = 1;
    }
    if (new_size == 0) {
        if (block) {
            memset(block, 0xDD, FAILING_HEAD + old_size + FAILING_TAIL); /* whoever still reads it will notice */
            a->live--;
            a->live_bytes -= old_size;
        }
        free(block);
        return NULL;
    }
    if (failing_refuses(a) || new_size > (size_t)1 << 40) {
        a->has_failed = 1;
        return NULL;
    }
    unsigned char *fresh = (unsigned char *)malloc(FAILING_HEAD + new_size + FAILING_TAIL);
    if (!fresh) return NULL;
    memset(fresh + FAILING_HEAD, 0xCD, new_size); /* nobody may count on zeros */
    memcpy(fresh, &new_size, sizeof new_size);
    memset(fresh + FAILING_HEAD + new_size, FAILING_BYTE, FAILING_TAIL);
    if (block) {
        memcpy(fresh + FAILING_HEAD, block + FAILING_HEAD, old_size < new_size ? old_size : new_size);
        memset(block, 0xDD, FAILING_HEAD + old_size + FAILING_TAIL);
        free(block);
        a->live--;
        a->live_bytes -= old_size;
    }
    a->live++;
    a->live_bytes += new_size;
    if (a->live_bytes > a->peak_bytes) a->peak_bytes = a->live_bytes;
    return fresh + FAILING_HEAD;
}

/* Blocks not freed; misuse counts as one. */
static inline int failing_live(const failing_allocator *a) { return a->live + a->misused; }

#endif
