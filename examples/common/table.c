#define _POSIX_C_SOURCE 200809L
#include "table.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void append(table *t, const char *text, size_t length) {
    if (t->used + length + 1 > t->capacity) {
        size_t capacity = 2 * t->capacity + length + 256;
        char *larger = realloc(t->text, capacity);
        if (!larger) {
            common_fail("out of memory for a table");
            return;
        }
        t->text = larger;
        t->capacity = capacity;
    }
    memcpy(t->text + t->used, text, length);
    t->text[t->used + length] = '\0';
    t->used += length + 1;
    t->cells++;
}

table table_begin(const char *header) {
    table t = {0, 0, NULL, 0, 0};
    for (const char *at = header; t.columns < TABLE_COLUMNS; t.columns++) {
        size_t length = strcspn(at, "|");
        append(&t, at, length);
        if (!at[length]) {
            t.columns++;
            break;
        }
        at += length + 1;
    }
    return t;
}

void table_cell(table *t, const char *format, ...) {
    char cell[400];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(cell, sizeof cell, format, arguments);
    va_end(arguments);
    append(t, cell, strlen(cell));
}

/* Letters in UTF-8, not bytes. */
static int letters(const char *text) {
    int n = 0;
    for (; *text; text++) n += ((unsigned char)*text & 0xC0) != 0x80;
    return n;
}

static bool is_number(const char *text) {
    char *end;
    strtod(text, &end);
    return end != text || strcmp(text, "-") == 0 || !*text;
}

void table_end_to(table *t, FILE *stream) {
    int width[TABLE_COLUMNS] = {0};
    bool left[TABLE_COLUMNS] = {false};
    const char *at = t->text;
    for (int i = 0; i < t->cells; i++, at += strlen(at) + 1) {
        int column = i % t->columns, n = letters(at);
        if (n > width[column]) width[column] = n;
        if (i >= t->columns && !is_number(at)) left[column] = true;
    }
    at = t->text;
    for (int i = 0; i < t->cells; i++, at += strlen(at) + 1) {
        int column = i % t->columns, pad = width[column] - letters(at);
        bool last = column == t->columns - 1;
        if (column) fputs(last && !*at ? "" : "  ", stream); /* no blanks at the end of a line */
        fprintf(stream, "%*s%s%*s", left[column] || (last && !*at) ? 0 : pad, "", at, left[column] && !last ? pad : 0, "");
        if (last || i == t->cells - 1) fputc('\n', stream);
        if (i == t->columns - 1)
            for (int k = 0; k < t->columns; k++) {
                if (k) fputs("  ", stream);
                for (int n = 0; n < width[k]; n++) fputc('-', stream);
                if (k == t->columns - 1) fputc('\n', stream);
            }
    }
    free(t->text);
    t->text = NULL;
    t->cells = 0;
    t->used = t->capacity = 0;
}

void table_end(table *t) {
    if (!common_quiet()) table_end_to(t, stdout);
    free(t->text);
    t->text = NULL;
    fflush(stdout);
}
