/* scene_feed.h: the sources that the feeds of a scene file stand for: one a class of sizes. */
#ifndef RIDDLE_SCENE_FEED_H
#define RIDDLE_SCENE_FEED_H

#include "scene.h"

int scene_region(tree_file *file, const region_def *def, dem_region *region);
int scene_add_sources(scene *s);
/* Time within which new particles leave half of a source's region [s]; infinite where nothing moves them. */
double scene_feed_interval(const scene *s, const source *q);
/* Particles of a class that a feed asks for, of a rate within a time [s]. */
double scene_number_of(const scene_feeder *f, int class, double time);
/* Smallest and largest diameter of a source [m]. */
void scene_extremes(const source *q, double *smallest, double *largest);
/* What is due between two times; *status. */
dem_status scene_feed(scene *s, scene_feeder *f, double from, double until);

#endif
