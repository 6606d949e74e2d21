/* utf8.h: characters in UTF-8. */
#ifndef UTF8_H
#define UTF8_H

#include <stddef.h>
#include <stdint.h>

/* Reads the character that begins at `at`, of which `left` bytes may be read (4: of a text that ends with 0). Returns
   its length, or 0 if these bytes are none. */
static inline size_t utf8_get(const unsigned char *at, size_t left, uint32_t *c) {
    static const uint32_t least[5] = {0, 0, 0x80, 0x800, 0x10000};
    const size_t n = at[0] < 0x80 ? 1 : at[0] >> 5 == 6 ? 2 : at[0] >> 4 == 14 ? 3 : at[0] >> 3 == 30 ? 4 : 0;
    if (n == 0 || n > left) return 0;
    *c = n == 1 ? at[0] : at[0] & (0x7fu >> n);
    for (size_t k = 1; k < n; k++) {
        if (at[k] >> 6 != 2) return 0;
        *c = *c << 6 | (at[k] & 63u);
    }
    return *c >= least[n] && *c < 0x110000 ? n : 0;
}

#endif
