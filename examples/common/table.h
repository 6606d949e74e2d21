/* table.h: an aligned table of plain text on stdout; nothing when --quiet.

       table t = table_begin("time [s]|retained small|retained near-mesh");
       table_cell(&t, "%.1f", time);  table_cell(&t, "%.3f", small);  table_cell(&t, "%.3f", near);   // cells run on, row by row
       table_end(&t); */
#ifndef RIDDLE_TABLE_H
#define RIDDLE_TABLE_H

#include <stddef.h>
#include <stdio.h>

#include "progress.h"

enum { TABLE_COLUMNS = 24 };

typedef struct table {
    int columns;
    int cells;  /* so far, header included */
    char *text; /* the cells, each ended by 0 */
    size_t used, capacity;
} table;

table table_begin(const char *header); /* at most TABLE_COLUMNS names between '|' */
void table_cell(table *t, const char *format, ...) COMMON_PRINTF(2, 3);
void table_end(table *t);                  /* prints and frees. Numbers stand to the right, texts to the left */
void table_end_to(table *t, FILE *stream); /* the same, to a stream, --quiet or not */

#endif
