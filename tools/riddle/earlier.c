/* earlier.c: see earlier.h */
#include "earlier.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"

static const char xml[] = "<?xml version=\"1.0\"?>\n<VTKFile ";

void earlier_remove(const char *folder, const char *name, const char *text) {
    char path[4096], begins[200];
    const size_t length = text ? strlen(text) : 0;
    if (strlen(folder) + strlen(name) + 2 > sizeof path || length > sizeof begins) return;
    FILE *file = fopen(riddle_io_path(path, sizeof path, folder, name), "rb");
    if (!file) return;
    const int same = fread(begins, 1, length, file) == length && (!text || memcmp(begins, text, length) == 0);
    fclose(file);
    if (same) remove(path);
}

/* Whether a name is "<stem>0012<ending>", as %04d writes the number. */
static int is_numbered(const char *name, const char *stem, const char *ending) {
    const size_t length = strlen(stem);
    if (strncmp(name, stem, length) != 0) return 0;
    const char *number = name + length;
    const size_t digits = strspn(number, "0123456789");
    return digits >= 4 && (digits == 4 || number[0] != '0') && strcmp(number + digits, ending) == 0;
}

/* Whether it is that of the movie of a continued run. */
static int is_later_movie(const char *name) {
    static const char stem[] = "scene_from_";
    char again[40];
    if (strncmp(name, stem, sizeof stem - 1) != 0) return 0;
    snprintf(again, sizeof again, "%s%gs.mp4", stem, strtod(name + sizeof stem - 1, NULL));
    return strcmp(name, again) == 0;
}

void earlier_remove_series(const char *folder) {
    static const char *const series[] = {"scene", "scene_walls", "scene_polyhedra"};
    char name[40];
    DIR *d = opendir(folder);
    if (!d) return;
    for (struct dirent *e; (e = readdir(d)) != NULL;) {
        for (int k = 0; k < 3; k++) {
            snprintf(name, sizeof name, "%s_", series[k]);
            if (is_numbered(e->d_name, name, ".vtp")) earlier_remove(folder, e->d_name, xml);
        }
        if (is_numbered(e->d_name, "particles_", ".csv")) earlier_remove(folder, e->d_name, "# time ");
        if (is_later_movie(e->d_name)) earlier_remove(folder, e->d_name, NULL);
    }
    closedir(d);
    for (int k = 0; k < 3; k++) {
        snprintf(name, sizeof name, "%s.pvd", series[k]);
        earlier_remove(folder, name, xml);
    }
    earlier_remove(folder, "scene.mp4", NULL);
}
