/* tree.h: a YAML (or JSON) text as a tree of values that know where they stand. By libyaml.

   An alias is the value that it stands for, not a copy. Refused, each with its place: what is no YAML, more than one
   document, keys that are no plain words, a key twice, an alias within its own anchor, more than 24 levels, more
   than 20 000 values. */
#ifndef RIDDLE_TREE_H
#define RIDDLE_TREE_H

#include <stddef.h>

typedef enum { TREE_TEXT, TREE_LIST, TREE_MAP } tree_kind;

typedef struct tree {
    tree_kind kind;
    int line, column; /* from 1 */
    const char *text; /* of a text */
    int quoted, open; /* 1: the text stands between quotes; still being read */
    int n, room;      /* list, map: how many */
    struct tree **item;
    const struct tree **key; /* map */
    const char *set;         /* the path of --set that it comes from; NULL: it stands in the file */
} tree;

typedef struct tree_file {
    const char *name; /* for messages */
    tree *root;       /* never NULL after success */
    void **block;     /* everything that belongs to it */
    int blocks, room;
    char message[400]; /* "scene.yaml:3:7: what is wrong", the first failure */
    char notes[2000];  /* lines for --check: what is allowed and yet may be a mistake */
} tree_file;

/* 0, or -1 with a message. Free with tree_free in both cases. name: kept, not copied. */
int tree_read(tree_file *file, const char *name, const char *bytes, size_t size);
void tree_free(tree_file *file);
/* Sets what stands at a path, "materials.glass.density", "feeds[2].rate", "walls.deck.vibrate.amplitude[3]" (counted
   from 1), to a value in
   YAML: in maps the last key may be new. 0, or -1 with a message. */
int tree_set(tree_file *file, const char *path, const char *value);
/* The value of a key, or NULL. */
const tree *tree_find(const tree *map, const char *key);
/* The path of a file whose name is relative to the folder of this one. */
const char *tree_beside(const tree_file *file, const char *name, char *path, size_t size);
/* Zeroed memory that lives as long as the file; NULL with a message. */
void *tree_memory(tree_file *file, size_t size);
/* Keeps the first message, "file:line:column: ...", and returns -1. at may be NULL: the file as a whole. */
int tree_fail(tree_file *file, const tree *at, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 3, 4)))
#endif
    ;
/* Adds a line to the notes; those that find no room are left out. */
void tree_note(tree_file *file, const tree *at, const char *format, ...)
#ifdef __GNUC__
    __attribute__((format(printf, 3, 4)))
#endif
    ;

#endif
