/* rows.h: the rows of measured.csv, whose columns hang on what the scene has. */
#ifndef RIDDLE_ROWS_H
#define RIDDLE_ROWS_H

#include "scene.h"

enum { ROWS_NAME = 96, ROWS_LEFT_FROM = 8 }; /* before the column of the first class: time, particles, ... */

typedef enum row_kind {
    ROW_VALUE,
    ROW_TAKEN, /* what an exit has taken, adding up [kg] */
    ROW_CLASS, /* one of many, of a class */
} row_kind;

typedef struct row_column {
    char name[ROWS_NAME];
    row_kind kind;
    const tree *where; /* what it is of */
} row_column;

typedef struct row_table {
    scene *s;
    row_column *column;
    double *value; /* [n][columns] */
    int columns, n, room;
    double looked; /* time of the last row [s] */
    struct rows_before *before;
    dem_region *region;        /* [measure.regions.n] */
    double *of_group, *of_all; /* for cells of mixing */
    int bodies;                /* 1: a particle may have several spheres */
    int powered;               /* 1: some wall moves */
    int mixing_from, heaps_from; /* columns of the first of each */
} row_table;

/* 0, or -1 with the message in the file: two columns of one name, a region that is none. */
int rows_open(row_table *r, scene *s);
void rows_free(row_table *r);
int rows_measure(row_table *r); /* one more; 0, or -1 after a printed line */
int rows_exchange(row_table *r, scene_state *io);
int rows_column(const row_table *r, const char *name); /* -1: none */
static inline double rows_at(const row_table *r, int row, int column) {
    return r->value[(size_t)row * (size_t)r->columns + (size_t)column];
}
/* Where the scene's feeds, exits and walls stand in it: whether a wall of the file is an exit, turns, moves. */
int rows_is_exit(const scene *s, int wall);
int rows_turns(const scene *s, int wall);
int rows_moves(const scene *s, int wall);
/* The axis of a wall that turns: a point and a unit vector. */
void rows_axis(const scene *s, int wall, dem_vec *point, dem_vec *axis);

#endif
