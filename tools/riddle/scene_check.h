/* scene_check.h: what can be said of a scene before it runs: pairs of materials without a contact, its size in
   particles, steps, time and memory. */
#ifndef RIDDLE_SCENE_CHECK_H
#define RIDDLE_SCENE_CHECK_H

#include "scene.h"

/* Whether two different materials may meet that no contact names; then a line says which and where. */
int scene_lacks_contact(const scene *s, char *line, size_t size);

typedef struct scene_size {
    double particles; /* that are fed, at most present at a time */
    double steps;
    double seconds; /* on one core, roughly */
    double bytes;
} scene_size;
scene_size scene_estimate(const scene *s);
/* "12000 particles, 2e5 steps: 4 min on one core, 30 MB" */
void scene_say_size(const scene_size *size, char *text, size_t length);

#endif
