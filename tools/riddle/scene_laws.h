/* scene_laws.h: the contact laws of dem_laws.h in a scene: elastic-plastic rolling, adhesion, bonds. */
#ifndef RIDDLE_SCENE_LAWS_H
#define RIDDLE_SCENE_LAWS_H

#include "scene.h"

/* Refuses keys that the law of the scene does not know; then, for one of these laws, fills s->laws and s->features,
   before the time step is chosen. 0, or -1 with the message in the file. */
int scene_laws_begin(scene *s);
void scene_laws_free(scene *s);
double scene_laws_step(const scene *s); /* the longest step that bonds allow [s]; infinite without */
dem_status scene_laws_run(scene *s, double now, double duration);
int scene_laws_bonds(const scene *s); /* whole ones, now */

#endif
