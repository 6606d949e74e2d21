/* scene_same.h: what a scene must have in common with the one that a save is of: every key but those that only say how
   long the run is and what it leaves behind. */
#ifndef RIDDLE_SCENE_SAME_H
#define RIDDLE_SCENE_SAME_H

#include "scene.h"

/* All keys with what the file says and what that is in SI units, defaults and the contents of other files included;
   they live as long as the file. NULL with the message in the file. */
char *scene_keys(const scene *s);
/* Whether both are of one scene: 0, or -1 with a message that names the first key that differs, with both values. */
int scene_same(scene *s, const char *keys, const char *saved);

#endif
