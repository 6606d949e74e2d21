/* scene_walls.h: the walls of a scene file in a world. */
#ifndef RIDDLE_SCENE_WALLS_H
#define RIDDLE_SCENE_WALLS_H

#include "scene.h"

int scene_material(tree_file *file, const scene_def *def, const scene_part *at, const char *key, const char *name, int *material);
int scene_add_walls(scene *s);
dem_vec scene_vec(const double *xyz);

#endif
