/* scene_materials.h: ready materials, to begin with. */
#ifndef RIDDLE_SCENE_MATERIALS_H
#define RIDDLE_SCENE_MATERIALS_H

#include "scene_def.h"

/* Fills what a material with `ready` does not say itself. 0, or -1 with the message in the file. */
int scene_fill_material(tree_file *file, material_def *m);
/* Prints all of them as a table in Markdown. */
void scene_list_materials(void);

#endif
