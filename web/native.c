/* native.c: the hash that the page must show: cc -O2 -ffp-contract=off web/native.c -lm -o native && ./native */
#include <stdio.h>

#include "scene.c"

int main(void) {
    printf("%016llx\n", (unsigned long long)web_check());
    fprintf(stderr, "%d spheres, %d bridges\n", web_default_spheres(), web_bridges());
    web_free();
    return 0;
}
