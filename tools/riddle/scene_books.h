/* scene_books.h: what came and what left, by class and exit: masses, sizes, times since they came. */
#ifndef RIDDLE_SCENE_BOOKS_H
#define RIDDLE_SCENE_BOOKS_H

#include "scene.h"

/* A particle that passed an exit. */
typedef struct gone {
    double time, age, diameter, mass; /* [s], [s], [m], [kg] */
    int group, exit;                  /* exit: wall of the world */
} gone;

/* Begins them, once walls and feeds are there. 0, or -1 with the message in the file. */
int scene_books_begin(scene *s);
void scene_books_free(scene *s);
/* Books the particles from `first` on, which have just come. */
dem_status scene_books_come(scene *s, ptrdiff_t first);
/* Books one that passed an exit. */
void scene_books_leave(scene *s, const dem_passed *p, double mass);
/* Notes the beginning of the separation's time, if it has come. */
void scene_books_look(scene *s, double now);
int scene_books_exchange(scene *s, scene_state *io);

/* Sums since the beginning: what came of a group; what left by an exit (a wall of the world). */
const tally *scene_came(const scene *s, int group);
const tally *scene_left(const scene *s, int wall, int group);
/* The same since the separation's `from`. */
tally scene_came_since(const scene *s, int group);
tally scene_left_since(const scene *s, int wall, int group);
/* Separation's cut [m]: that of the file, or the aperture of the first screen; NaN: none. */
double scene_cut(const scene *s);
/* Particles that have left, if `output: passed` asks for them. */
const gone *scene_gone(const scene *s, int *n);

/* Whether a list of words with blanks, commas or semicolons names a text: itself, or its beginning before '*'. */
int scene_named(const char *words, const char *text);

#endif
