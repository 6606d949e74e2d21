/* scene_sieves.h: sieves of a scene, given or of a series of ISO 565, and size distributions that are cut at them. */
#ifndef RIDDLE_SCENE_SIEVES_H
#define RIDDLE_SCENE_SIEVES_H

#include "scene.h"

/* Sets the sieves of a scene whose feeds have diameters from smallest to largest. 0, or -1 with the message
   in the file. */
int scene_make_sieves(scene *s, double smallest, double largest);
/* The class of a diameter: the number of sieves that it stays on. It lies from low on (0: below the finest sieve) to
   below high (infinite). */
int scene_sieve_class(const scene *s, double diameter, double *low, double *high);
/* The share of a distribution between two diameters, of mass or number as it counts [-]; not of a list. */
double scene_share_between(const dem_sizes *sizes, double from, double to);

#endif
