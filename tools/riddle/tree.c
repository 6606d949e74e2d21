/* tree.c: see tree.h */
#include "tree.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

enum { DEPTH_MAX = 24, VALUES_MAX = 20000 };

typedef struct anchor {
    const char *name;
    tree *value;
} anchor;

typedef struct reading {
    tree_file *file;
    const char *set; /* see tree */
    yaml_parser_t parser;
    anchor *anchors;
    int n_anchors, anchor_room, values;
} reading;

/* "scene.yaml:3:7: what is said", or "scene.yaml: --set duration: ...", without control characters. */
static void say(const tree_file *file, const tree *at, char *line, size_t size, const char *format, va_list arguments) {
    int used = at && at->set ? snprintf(line, size, "%s: --set %.100s: ", file->name, at->set)
               : at          ? snprintf(line, size, "%s:%d:%d: ", file->name, at->line, at->column)
                             : snprintf(line, size, "%s: ", file->name);
    if (used < 0 || used >= (int)size) used = (int)size - 1;
    vsnprintf(line + used, size - (size_t)used, format, arguments);
    for (char *c = line; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127) *c = '?';
}

int tree_fail(tree_file *file, const tree *at, const char *format, ...) {
    if (file->message[0]) return -1;
    va_list arguments;
    va_start(arguments, format);
    say(file, at, file->message, sizeof file->message, format, arguments);
    va_end(arguments);
    return -1;
}

void tree_note(tree_file *file, const tree *at, const char *format, ...) {
    char line[400];
    const size_t used = strlen(file->notes);
    va_list arguments;
    va_start(arguments, format);
    say(file, at, line, sizeof line, format, arguments);
    va_end(arguments);
    if (used + strlen(line) + 2 < sizeof file->notes)
        snprintf(file->notes + used, sizeof file->notes - used, "%s\n", line);
}

void *tree_memory(tree_file *file, size_t size) {
    if (file->blocks == file->room) {
        const int room = file->room ? 2 * file->room : 64;
        void **more = realloc(file->block, (size_t)room * sizeof *more);
        if (!more) return tree_fail(file, NULL, "out of memory"), NULL;
        file->block = more, file->room = room;
    }
    void *memory = calloc(1, size ? size : 1);
    if (!memory) return tree_fail(file, NULL, "out of memory"), NULL;
    return file->block[file->blocks++] = memory;
}

void tree_free(tree_file *file) {
    for (int k = 0; k < file->blocks; k++) free(file->block[k]);
    free(file->block);
    memset(file, 0, sizeof *file);
}

const tree *tree_find(const tree *map, const char *key) {
    for (int k = 0; map && map->kind == TREE_MAP && k < map->n; k++)
        if (strcmp(map->key[k]->text, key) == 0) return map->item[k];
    return NULL;
}

const char *tree_beside(const tree_file *file, const char *name, char *path, size_t size) {
    const char *slash = strrchr(file->name, '/');
    const int folder = slash && name[0] != '/' ? (int)(slash - file->name) + 1 : 0;
    snprintf(path, size, "%.*s%s", folder, file->name, name);
    return path;
}

static char *copied(tree_file *file, const char *text, size_t length) {
    char *copy = tree_memory(file, length + 1);
    if (copy) memcpy(copy, text, length);
    return copy;
}

/* An empty value at a place, for messages too. */
static tree value_at(const reading *r, tree_kind kind, yaml_mark_t mark) {
    tree value;
    memset(&value, 0, sizeof value);
    value.kind = kind, value.set = r->set;
    value.line = (int)mark.line + 1, value.column = (int)mark.column + 1;
    return value;
}

static tree *new_value(reading *r, tree_kind kind, const yaml_event_t *event) {
    tree *value = tree_memory(r->file, sizeof *value);
    if (!value) return NULL;
    *value = value_at(r, kind, event->start_mark);
    if (++r->values > VALUES_MAX) return tree_fail(r->file, value, "more than %d values", VALUES_MAX), NULL;
    return value;
}

/* Lists are few and short: what they leave behind as they grow is freed with the file. */
static int append(reading *r, tree *list, const tree *key, tree *value) {
    if (list->n == list->room) {
        const int room = list->room ? 2 * list->room : 8;
        tree **item = tree_memory(r->file, (size_t)room * sizeof *item);
        const tree **keys = tree_memory(r->file, (size_t)room * sizeof *keys);
        if (!item || !keys) return -1;
        if (list->n)
            memcpy(item, list->item, (size_t)list->n * sizeof *item),
                memcpy(keys, list->key, (size_t)list->n * sizeof *keys);
        list->item = item, list->key = keys, list->room = room;
    }
    list->key[list->n] = key;
    list->item[list->n++] = value;
    return 0;
}

static int remember(reading *r, const yaml_char_t *name, tree *value) {
    if (!name) return 0;
    if (r->n_anchors == r->anchor_room) {
        const int room = r->anchor_room ? 2 * r->anchor_room : 16;
        anchor *more = tree_memory(r->file, (size_t)room * sizeof *more);
        if (!more) return -1;
        if (r->n_anchors) memcpy(more, r->anchors, (size_t)r->n_anchors * sizeof *more);
        r->anchors = more, r->anchor_room = room;
    }
    anchor *a = &r->anchors[r->n_anchors];
    a->name = copied(r->file, (const char *)name, strlen((const char *)name));
    a->value = value;
    if (!a->name) return -1;
    r->n_anchors++;
    return 0;
}

/* The next event; what libyaml finds wrong, with its place. */
static int next(reading *r, yaml_event_t *event) {
    if (yaml_parser_parse(&r->parser, event)) return 0;
    const yaml_mark_t mark = r->parser.problem ? r->parser.problem_mark : r->parser.mark;
    const tree at = value_at(r, TREE_TEXT, mark);
    return tree_fail(r->file, &at, "no YAML: %s", r->parser.problem ? r->parser.problem : "unreadable");
}

static tree *read_value(reading *r, yaml_event_t *event, int depth);

static int read_list(reading *r, tree *list, int depth) {
    yaml_event_t event;
    for (;;) {
        if (next(r, &event)) return -1;
        const int end = event.type == YAML_SEQUENCE_END_EVENT;
        tree *value = end ? NULL : read_value(r, &event, depth + 1);
        yaml_event_delete(&event);
        if (end) return 0;
        if (!value || append(r, list, NULL, value)) return -1;
    }
}

static int read_map(reading *r, tree *map, int depth) {
    yaml_event_t event;
    for (;;) {
        if (next(r, &event)) return -1;
        const int end = event.type == YAML_MAPPING_END_EVENT;
        tree *key = end ? NULL : read_value(r, &event, depth + 1);
        yaml_event_delete(&event);
        if (end) return 0;
        if (!key) return -1;
        if (key->kind != TREE_TEXT) return tree_fail(r->file, key, "a key must be a plain word");
        if (tree_find(map, key->text)) return tree_fail(r->file, key, "%.60s: this key stands here twice", key->text);
        if (next(r, &event)) return -1;
        tree *value = read_value(r, &event, depth + 1);
        yaml_event_delete(&event);
        if (!value || append(r, map, key, value)) return -1;
    }
}

static tree *read_alias(reading *r, const yaml_event_t *event) {
    const tree at = value_at(r, TREE_TEXT, event->start_mark);
    const char *name = (const char *)event->data.alias.anchor;
    for (int k = r->n_anchors - 1; k >= 0; k--) {
        if (strcmp(r->anchors[k].name, name) != 0) continue;
        if (r->anchors[k].value->open) return tree_fail(r->file, &at, "*%.60s stands within itself", name), NULL;
        return r->anchors[k].value;
    }
    return tree_fail(r->file, &at, "*%.60s: no anchor of this name before", name), NULL;
}

static tree *read_value(reading *r, yaml_event_t *event, int depth) {
    tree *value = NULL;
    const yaml_char_t *name = NULL;
    int failed = 0;
    switch (event->type) {
    case YAML_ALIAS_EVENT: return read_alias(r, event);
    case YAML_SCALAR_EVENT:
        value = new_value(r, TREE_TEXT, event);
        if (!value) return NULL;
        if (strlen((const char *)event->data.scalar.value) != event->data.scalar.length)
            return tree_fail(r->file, value, "a zero byte in a text"), NULL;
        value->text = copied(r->file, (const char *)event->data.scalar.value, event->data.scalar.length);
        value->quoted = event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
        return value->text && remember(r, event->data.scalar.anchor, value) == 0 ? value : NULL;
    case YAML_SEQUENCE_START_EVENT: name = event->data.sequence_start.anchor; break;
    case YAML_MAPPING_START_EVENT: name = event->data.mapping_start.anchor; break;
    default: return tree_fail(r->file, NULL, "no value where one is expected"), NULL;
    }
    const int is_map = event->type == YAML_MAPPING_START_EVENT;
    value = new_value(r, is_map ? TREE_MAP : TREE_LIST, event);
    if (!value || remember(r, name, value)) return NULL;
    if (depth >= DEPTH_MAX) return tree_fail(r->file, value, "more than %d levels", DEPTH_MAX), NULL;
    value->open = 1;
    failed = is_map ? read_map(r, value, depth) : read_list(r, value, depth);
    value->open = 0;
    return failed ? NULL : value;
}

static int read_document(reading *r) {
    yaml_event_t event;
    for (;;) {
        if (next(r, &event)) return -1;
        const yaml_event_type_t type = event.type;
        const tree at = value_at(r, TREE_MAP, event.start_mark);
        int bad = 0;
        if (type == YAML_DOCUMENT_START_EVENT && r->file->root) bad = tree_fail(r->file, &at, "a second document");
        else if (type != YAML_STREAM_START_EVENT && type != YAML_DOCUMENT_START_EVENT &&
                 type != YAML_DOCUMENT_END_EVENT && type != YAML_STREAM_END_EVENT) {
            r->file->root = read_value(r, &event, 0);
            bad = r->file->root ? 0 : -1;
        }
        yaml_event_delete(&event);
        if (bad) return -1;
        if (type == YAML_STREAM_END_EVENT) break;
    }
    return r->file->root ? 0 : tree_fail(r->file, NULL, "nothing in it");
}

int tree_read(tree_file *file, const char *name, const char *bytes, size_t size) {
    reading r;
    memset(&r, 0, sizeof r);
    memset(file, 0, sizeof *file);
    file->name = name;
    r.file = file;
    if (!yaml_parser_initialize(&r.parser)) return tree_fail(file, NULL, "out of memory");
    yaml_parser_set_input_string(&r.parser, (const unsigned char *)bytes, size);
    const int failed = read_document(&r);
    yaml_parser_delete(&r.parser);
    return failed ? (tree_fail(file, NULL, "unreadable"), -1) : 0;
}

/* ---- values from the command line ---- */

/* The next step of a path: ".key" or "[3]" (or "key" at its beginning). Returns what is behind it, or NULL. index:
   -1 for a key. */
static const char *step_of(const char *path, char *key, size_t size, int *index) {
    char *end;
    *index = -1, key[0] = '\0';
    if (*path == '[') {
        const long number = strtol(path + 1, &end, 10);
        *index = number >= 1 && number <= VALUES_MAX ? (int)number - 1 : VALUES_MAX;
        return end > path + 1 && *end == ']' ? end + 1 : NULL;
    }
    if (*path == '.') path++;
    const size_t length = strcspn(path, ".[");
    if (length == 0 || length >= size) return NULL;
    memcpy(key, path, length);
    key[length] = '\0';
    return path + length;
}

static int refuse_path(tree_file *file, const char *path, const char *why) {
    return tree_fail(file, NULL, "--set %.100s: %s", path, why);
}

/* Reads a value for a path into the file that it becomes a part of. */
static tree *read_piece(tree_file *file, const char *path, const char *text) {
    reading r;
    memset(&r, 0, sizeof r);
    r.set = copied(file, path, strlen(path));
    if (!r.set) return NULL;
    tree_file piece = *file;
    piece.root = NULL;
    r.file = &piece;
    if (!yaml_parser_initialize(&r.parser)) return tree_fail(file, NULL, "out of memory"), NULL;
    yaml_parser_set_input_string(&r.parser, (const unsigned char *)text, strlen(text));
    const int failed = read_document(&r);
    yaml_parser_delete(&r.parser);
    tree *root = failed ? NULL : piece.root;
    piece.root = file->root;
    *file = piece; /* with the memory of the piece */
    return root;
}

/* The element of a list of contacts whose materials are these, "glass-steel", in either order; -1: there is none. */
static int element_between(const tree *list, const char *pair) {
    char forth[200], back[200];
    for (int k = 0; k < list->n; k++) {
        const tree *two = tree_find(list->item[k], "between");
        if (!two || two->kind != TREE_LIST || two->n != 2 || two->item[0]->kind != TREE_TEXT ||
            two->item[1]->kind != TREE_TEXT)
            continue;
        snprintf(forth, sizeof forth, "%.90s-%.90s", two->item[0]->text, two->item[1]->text);
        snprintf(back, sizeof back, "%.90s-%.90s", two->item[1]->text, two->item[0]->text);
        if (strcmp(pair, forth) == 0 || strcmp(pair, back) == 0) return k;
    }
    return -1;
}

int tree_set(tree_file *file, const char *path, const char *value) {
    char key[80];
    int index;
    tree **place = &file->root, *fresh = read_piece(file, path, value);
    if (!fresh) return -1;
    const char *at = path;
    while (*at) {
        tree *now = *place;
        at = step_of(at, key, sizeof key, &index);
        if (!at) return refuse_path(file, path, "a path is wanted, such as materials.glass.density or feeds[1].rate");
        if (index < 0 && now->kind == TREE_LIST) {
            index = element_between(now, key);
            if (index < 0) return refuse_path(file, path, "no element of this list is between these two materials");
        }
        if (index >= 0) {
            if (now->kind != TREE_LIST || index >= now->n)
                return refuse_path(file, path, "there is no such element of a list");
            place = &now->item[index];
            continue;
        }
        if (now->kind != TREE_MAP) return refuse_path(file, path, "a key of what has none");
        int k = 0;
        while (k < now->n && strcmp(now->key[k]->text, key) != 0) k++;
        if (k == now->n && *at) return refuse_path(file, path, "there is no such key on the way");
        if (k == now->n) {
            reading r;
            memset(&r, 0, sizeof r);
            r.file = file;
            tree *name = tree_memory(file, sizeof *name);
            if (!name) return -1;
            name->set = fresh->set;
            name->kind = TREE_TEXT, name->text = copied(file, key, strlen(key));
            if (!name->text || append(&r, now, name, fresh)) return -1;
        }
        place = &now->item[k];
    }
    *place = fresh;
    return 0;
}
