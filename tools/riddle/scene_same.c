/* scene_same.c: see scene_same.h. A line a key: its path, what the file says, what it is; tabs between. */
#include "scene_same.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "input.h"

static const char *const may_change[] = {"title", "duration", "output", "stop"};
static const char allowed[] = "only duration, output, stop and title may change";

/* ---- writing ---- */

typedef struct writing {
    tree_file *file;
    char *text;
    size_t size, room;
    int failed;
} writing;

static void put(writing *w, char end, const char *format, ...) COMMON_PRINTF(3, 4);
static void put(writing *w, char end, const char *format, ...) {
    char some[500];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(some, sizeof some, format, arguments);
    va_end(arguments);
    const size_t length = strlen(some);
    if (w->room - w->size < length + 2) { /* what it leaves behind as it grows is freed with the file */
        char *more = tree_memory(w->file, 2 * w->room + 4096);
        if (!more) {
            w->failed = 1;
            return;
        }
        if (w->size) memcpy(more, w->text, w->size);
        w->text = more, w->room = 2 * w->room + 4096;
    }
    for (size_t k = 0; k < length; k++) w->text[w->size++] = (unsigned char)some[k] < 32 ? ' ' : some[k];
    w->text[w->size++] = end;
    w->text[w->size] = '\0';
}

/* What the file says of a key, or its default. */
static void put_said(writing *w, const scene_part *part, const scene_field *f, const char *otherwise) {
    const tree *v = tree_find(part->where, f->key);
    if (v && v->kind == TREE_TEXT) put(w, '\t', "%.200s", v->text);
    else if (v && v->kind == TREE_LIST && v->n == 3 && f->kind == FIELD_VECTOR)
        put(w, '\t', "[%.60s, %.60s, %.60s]", v->item[0]->text, v->item[1]->text, v->item[2]->text);
    else if (!v && f->fallback && f->fallback[0]) put(w, '\t', "%s (default)", f->fallback);
    else put(w, '\t', "%s", otherwise);
}

/* Another file is what it contains. */
static void put_file(writing *w, const char *path, const char *name) {
    char full[1000], message[300];
    size_t size;
    char *bytes = input_read(tree_beside(w->file, name, full, sizeof full), &size, message, sizeof message);
    if (!bytes) {
        tree_fail(w->file, NULL, "%s: %s", path, message);
        w->failed = 1;
        return;
    }
    const unsigned long long sum = state_checksum(bytes, size);
    free(bytes);
    put(w, '\t', "%s", path);
    put(w, '\t', "%.200s (%.0f bytes, checksum %08llx)", name, (double)size, sum >> 32);
    put(w, '\n', "%016llx", sum);
}

static void put_part(writing *w, const char *path, const scene_table *table, const void *part);

static void put_list(writing *w, const char *path, const scene_field *f, const scene_list *list) {
    char below[300];
    for (int k = 0; k < list->n; k++) {
        const scene_part *item =
            (const scene_part *)(const void *)((const char *)list->item + (size_t)k * f->section->size);
        if (item->name) snprintf(below, sizeof below, "%.200s.%.60s", path, item->name);
        else snprintf(below, sizeof below, "%.200s[%d]", path, k + 1);
        put_part(w, below, f->section, item);
    }
}

static void put_field(writing *w, const char *path, const scene_part *part, const scene_field *f) {
    const void *at = (const char *)part + f->at;
    char number[60];
    const double *x = at;
    const char *const *text = at;
    const scene_list *list = at;
    switch (f->kind) {
    case FIELD_NUMBER:
    case FIELD_WHOLE:
        if (isnan(*x)) return;
        snprintf(number, sizeof number, "%.6g s, a hundredth of the duration", *x); /* measure.every */
        put(w, '\t', "%s", path);
        put_said(w, part, f, number);
        put(w, '\n', "%.17g", *x);
        return;
    case FIELD_YES:
    case FIELD_CHOICE:
        put(w, '\t', "%s", path);
        put_said(w, part, f, "");
        put(w, '\n', "%d", *(const int *)at);
        return;
    case FIELD_FILE:
        if (*text) put_file(w, path, *text);
        return;
    case FIELD_TEXT:
        if (*text) put(w, '\t', "%s", path), put(w, '\t', "%.200s", *text), put(w, '\n', "%.200s", *text);
        return;
    case FIELD_TWO:
        put(w, '\t', "%s", path);
        put(w, '\t', "[%.60s, %.60s]", text[0], text[1]);
        put(w, '\n', "%.60s %.60s", text[0], text[1]);
        return;
    case FIELD_VECTOR:
        if (isnan(x[0])) return;
        put(w, '\t', "%s", path);
        put_said(w, part, f, "");
        put(w, '\n', "%.17g %.17g %.17g", x[0], x[1], x[2]);
        return;
    case FIELD_POINTS:
        for (int k = 0; k < list->n; k++) {
            x = (const double *)list->item + 3 * k;
            put(w, '\t', "%s[%d]", path, k + 1);
            put(w, '\t', "[%g, %g, %g] m", x[0], x[1], x[2]);
            put(w, '\n', "%.17g %.17g %.17g", x[0], x[1], x[2]);
        }
        return;
    case FIELD_NUMBERS:
    case FIELD_PAIRS:
        for (int k = 0; k < list->n; k++) {
            const int pair = f->kind == FIELD_PAIRS;
            x = (const double *)list->item + (pair ? 2 : 1) * k;
            put(w, '\t', "%s[%d]", path, k + 1);
            if (pair) put(w, '\t', "[%g s, %g]", x[0], x[1]), put(w, '\n', "%.17g %.17g", x[0], x[1]);
            else put(w, '\t', "%g", x[0]), put(w, '\n', "%.17g", x[0]);
        }
        return;
    case FIELD_PART:
        if (((const scene_part *)at)->where) put_part(w, path, f->section, at);
        return;
    case FIELD_LIST:
    case FIELD_NAMED: put_list(w, path, f, list);
    }
}

static void put_part(writing *w, const char *path, const scene_table *table, const void *part) {
    char below[300];
    put(w, '\t', "%s", path);
    put(w, '\t', "there");
    put(w, '\n', "1");
    for (int k = 0; k < table->n && !w->failed; k++) {
        snprintf(below, sizeof below, "%.200s%s%s", path, path[0] ? "." : "", table->field[k].key);
        put_field(w, below, part, &table->field[k]);
    }
}

char *scene_keys(const scene *s) {
    writing w;
    memset(&w, 0, sizeof w);
    w.file = s->file;
    for (int k = 0; k < scene_section.n && !w.failed; k++) {
        const scene_field *f = &scene_section.field[k];
        const void *at = (const char *)s->def + f->at;
        int skipped = 0;
        for (size_t n = 0; n < sizeof may_change / sizeof *may_change; n++)
            skipped |= strcmp(may_change[n], f->key) == 0;
        if (skipped) continue;
        if (strcmp(f->key, "seed") == 0) /* an option may have set it */
            put(&w, '\t', "seed"), put(&w, '\t', "%llu", (unsigned long long)s->seed),
                put(&w, '\n', "%llu", (unsigned long long)s->seed);
        /* `every` counts where it is not given, too */
        else if (strcmp(f->key, "measure") == 0) put_part(&w, f->key, f->section, at);
        else put_field(&w, f->key, &s->def->part, f);
    }
    return w.failed ? NULL : w.text;
}

/* ---- comparing ---- */

typedef struct line {
    char key[300], said[300], value[300];
} line;

/* The line at a place, and the place of the next; NULL: there is none. */
static const char *next_line(const char *at, line *l) {
    char *const into[3] = {l->key, l->said, l->value};
    memset(l, 0, sizeof *l);
    if (!*at) return NULL;
    for (int k = 0; k < 3; k++) {
        const size_t length = strcspn(at, "\t\n");
        memcpy(into[k], at, length < 299 ? length : 299);
        at += length;
        if (*at) at++;
    }
    return at;
}

static int has_key(const char *lines, const char *key) {
    line l;
    while ((lines = next_line(lines, &l)) != NULL)
        if (strcmp(l.key, key) == 0) return 1;
    return 0;
}

/* Where a path such as walls.drum.rotate.speed or feeds[2].count stands in the file, or what is nearest above it. */
static const tree *place_of(const tree *at, const char *path) {
    while (*path) {
        char word[100];
        const tree *below = NULL;
        /* a name may have points */
        for (size_t length = strcspn(path, ".["); !below; length += 1 + strcspn(path + length + 1, ".[")) {
            if (length >= sizeof word) return at;
            memcpy(word, path, length);
            word[length] = '\0';
            below = tree_find(at, word);
            if (below) path += length;
            else if (!path[length]) return at;
        }
        at = below;
        if (*path == '[') {
            const long k = strtol(path + 1, (char **)&path, 10);
            if (at->kind != TREE_LIST || k < 1 || k > at->n) return at;
            at = at->item[k - 1];
            path += *path == ']';
        }
        path += *path == '.';
    }
    return at;
}

int scene_same(scene *s, const char *keys, const char *saved) {
    line now, before;
    for (;;) {
        const char *next_key = next_line(keys, &now), *next_saved = next_line(saved, &before);
        if (!next_key && !next_saved) return 0;
        const int same_key = strcmp(now.key, before.key) == 0;
        if (same_key && strcmp(now.value, before.value) == 0) {
            keys = next_key, saved = next_saved;
            continue;
        }
        const tree *at = place_of(s->file->root, next_key ? now.key : before.key);
        if (same_key)
            return tree_fail(s->file, at, "--continue: %s is %.80s, in the save %.80s: %s", now.key, now.said,
                             before.said, allowed);
        if (next_key && !has_key(saved, now.key))
            return tree_fail(s->file, at, "--continue: %s is %.80s, in the save it is not given: %s", now.key, now.said,
                             allowed);
        at = place_of(s->file->root, before.key);
        if (next_saved && !has_key(keys, before.key))
            return tree_fail(s->file, at, "--continue: %s is not given, in the save it is %.80s: %s", before.key,
                             before.said, allowed);
        return tree_fail(s->file, at, "--continue: %s stands at another place in the save: %s", now.key, allowed);
    }
}
