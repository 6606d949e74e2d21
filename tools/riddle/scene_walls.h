/* scene_walls.h: the walls of a scene file in a world. */
#ifndef RIDDLE_SCENE_WALLS_H
#define RIDDLE_SCENE_WALLS_H

#include "scene.h"

int scene_material(tree_file *file, const scene_def *def, const scene_part *at, const char *key, const char *name,
                   int *material);
int scene_add_walls(scene *s);
/* Sets the speed of a wall's belt to what the file says, times a factor. */
dem_status scene_set_belt(scene *s, const wall_def *w, int wall, double factor);
/* Reads an STL file whose name is relative to the scene's folder. Free the mesh with dem_free_mesh. */
int scene_read_stl(tree_file *file, const tree *at, const char *name, double unit, double weld, dem_mesh *mesh);
dem_vec scene_vec(const double *xyz);

#endif
