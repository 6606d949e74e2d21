/* pattern.c: linked to every test program: with RIDDLE_TEST_PATTERN set (scripts/test NAME PATTERN) only tests of
   these names run. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

__attribute__((constructor)) static void choose_tests(void) {
    const char *pattern = getenv("RIDDLE_TEST_PATTERN");
    if (pattern && pattern[0]) cmocka_set_test_filter(pattern);
}
