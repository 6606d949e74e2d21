/* fields.h: a part of a scene as a table of its keys. The table reads the values, refuses what is not allowed, gives
   the defaults, and is the reference in docs/scene_files.md. */
#ifndef RIDDLE_FIELDS_H
#define RIDDLE_FIELDS_H

#include <stdbool.h>

#include "tree.h"

/* What a number measures. A bare number is in SI units, but angles and speeds of rotation must name theirs, and so
   must diameters above 1 m: who writes 4 means 4 mm. */
typedef enum unit_kind {
    UNIT_NONE,
    UNIT_SHARE,
    UNIT_LENGTH,
    UNIT_DIAMETER,
    UNIT_TIME,
    UNIT_MASS,
    UNIT_MASS_FLOW,
    UNIT_ANGLE,
    UNIT_FREQUENCY,
    UNIT_SPIN,
    UNIT_SPEED,
    UNIT_ACCELERATION,
    UNIT_STRESS,
    UNIT_DENSITY,
    UNIT_STIFFNESS,
    UNIT_VISCOSITY,
    UNIT_TENSION,
    UNIT_FORCE,
    UNIT_TORQUE,
    UNIT_DAMPING,
    UNIT_INERTIA
} unit_kind;

typedef enum field_kind {
    FIELD_NUMBER,  /* double */
    FIELD_WHOLE,   /* double, a whole number */
    FIELD_YES,     /* int: yes or no */
    FIELD_TEXT,    /* const char * */
    FIELD_FILE,    /* the same, the name of a file, relative to the folder of this one */
    FIELD_TWO,     /* const char *[2] */
    FIELD_CHOICE,  /* int: which of choices, "linear|hertz" */
    FIELD_VECTOR,  /* double[3] */
    FIELD_POINTS,  /* scene_list of double[3] */
    FIELD_NUMBERS, /* scene_list of double */
    FIELD_PAIRS,   /* scene_list of double[2]: a time, and a number with the unit */
    FIELD_PART,    /* a struct in its place, beginning with a scene_part */
    FIELD_LIST,    /* scene_list of such structs */
    FIELD_NAMED    /* the same, as a map from names */
} field_kind;

/* How every struct begins that a table describes. */
typedef struct scene_part {
    const tree *where; /* NULL: the key was not given */
    const char *name;  /* FIELD_NAMED: its key; else NULL */
} scene_part;
typedef struct scene_list {
    int n;
    void *item; /* [n] of the struct */
} scene_list;

typedef struct scene_field {
    const char *key;
    field_kind kind;
    unit_kind unit;
    size_t at; /* offsetof */
    double low, high;
    bool above;           /* low itself is not allowed */
    const char *fallback; /* as it would stand in a file; NULL: the key must be given; "": absent (NaN, NULL, none) */
    int group;            /* 1, 2, ...: exactly one of the keys of a group must be given; 0: none */
    const char *choices;
    const struct scene_table *section;
    const char *help;
} scene_field;

typedef struct scene_table {
    const char *title, *help;
    const scene_field *field;
    int n;
    size_t size;
} scene_table;

/* Fills *into from a map by its table; 0, or -1 with the message in the file. */
int fields_read(tree_file *file, const tree *map, const scene_table *s, void *into);
/* The place of a key within a part, or of the part itself. */
const tree *fields_where(const scene_part *p, const char *key);
/* Refuses a word with the nearest of the allowed ones; -1. what: "key". */
int fields_refuse_word(tree_file *file, const tree *at, const char *what, const char *word, const char *const *allowed,
                       int n);
/* All keys as Markdown, the given section and those below it, on stdout. */
void fields_describe(const scene_table *root);

#endif
