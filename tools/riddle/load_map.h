/* load_map.h: what particles do to each triangle of a wall, for wear: sampled after every tick. */
#ifndef RIDDLE_LOAD_MAP_H
#define RIDDLE_LOAD_MAP_H

#include "scene.h"

typedef struct load_maps load_maps;

/* The maps of all walls with `load_map`; NULL with the message in the file: a wall has no triangles. */
load_maps *load_maps_open(scene *s);
/* Adds what the contacts do now, for a time of this length [s]. */
void load_maps_add(load_maps *m, double time);
/* Writes loads_<wall>.vtp and .csv; `wrote` gets the name of each that is there. */
void load_maps_write(const load_maps *m, const char *folder, void (*wrote)(void *user, const char *name), void *user);
int load_maps_exchange(load_maps *m, scene_state *io);

#endif
