/* templates.h: the scenes that come with the program, in the program itself, so that it serves wherever it
   is installed. */
#ifndef TEMPLATES_H
#define TEMPLATES_H

typedef struct scene_template {
    const char *name;
    const char *const *line; /* up to a null pointer */
} scene_template;

extern const scene_template templates[]; /* up to one without a name */

#endif
