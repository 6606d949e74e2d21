/* scene_wet.h: the liquid of a scene: films, bridges, their books. */
#ifndef RIDDLE_SCENE_WET_H
#define RIDDLE_SCENE_WET_H

#include "scene.h"

int scene_wet_begin(scene *s); /* does nothing in a dry scene */
void scene_wet_free(scene *s);
dem_status scene_wet_new(scene *s, const scene_feeder *f,
                         ptrdiff_t first); /* films on a feed's particles from `first` on */
dem_status scene_wet_run(scene *s, double duration);
int scene_wet_exchange(scene *s, scene_state *io); /* before the world is loaded: books; the links' law is told after */
int scene_wet_link(scene *s);
double scene_wet_total(const scene *s, int *bridges); /* on what is still there, walls included [m3] */

#endif
