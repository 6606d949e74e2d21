/* scene_books.c: see scene_books.h */
#include "scene_books.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct books {
    tally *came, *left;               /* [groups], [walls of the world][groups] */
    tally *came_before, *left_before; /* at the beginning of the separation */
    double began;                     /* 1: it has begun */
    double *born;                     /* by id [s] */
    uint64_t ids, room;
    gone *gone;
    int left_count, left_room;
};

static const char blanks[] = " ,;\n";

int scene_named(const char *words, const char *text) {
    for (const char *at = words; at && *(at += strspn(at, blanks));) {
        const size_t length = strcspn(at, blanks);
        if (at[length - 1] == '*' ? strncmp(at, text, length - 1) == 0
                                  : strlen(text) == length && strncmp(at, text, length) == 0)
            return 1;
        at += length;
    }
    return 0;
}

double scene_cut(const scene *s) {
    const wall_def *w = s->def->walls.item;
    if (!isnan(s->def->measure.separation.cut)) return s->def->measure.separation.cut;
    for (int k = 0; k < s->def->walls.n; k++)
        if (w[k].screen.part.where) return w[k].screen.aperture;
    return (double)NAN;
}

/* Every word names an exit. */
static int check_exits(scene *s, const char *key, const char *words) {
    const separation_def *d = &s->def->measure.separation;
    const wall_def *w = s->def->walls.item;
    char word[80];
    for (const char *at = words; at && *(at += strspn(at, blanks));) {
        const size_t length = strcspn(at, blanks);
        const char *exits[DEM_WALLS_MAX];
        int n = 0, found = 0;
        snprintf(word, sizeof word, "%.*s", (int)(length < 79 ? length : 79), at);
        for (int k = 0; k < s->def->walls.n; k++)
            if (w[k].exit.part.where) exits[n++] = w[k].part.name, found |= scene_named(word, w[k].part.name);
        if (!found && n == 0)
            return tree_fail(s->file, fields_where(&d->part, key), "%s: %.60s: no exit of that name; there is none",
                             key, word);
        if (!found) return fields_refuse_word(s->file, fields_where(&d->part, key), "exit", word, exits, n);
        at += length;
    }
    return 0;
}

static int check_separation(scene *s) {
    const separation_def *d = &s->def->measure.separation;
    const wall_def *w = s->def->walls.item;
    if (!d->part.where) return 0;
    if (check_exits(s, "fine", d->fine) || check_exits(s, "coarse", d->coarse)) return -1;
    for (int k = 0; d->coarse && k < s->def->walls.n; k++)
        if (w[k].exit.part.where && scene_named(d->fine, w[k].part.name) && scene_named(d->coarse, w[k].part.name))
            return tree_fail(s->file, fields_where(&d->part, "coarse"), "coarse: %s: it is one of fine",
                             w[k].part.name);
    if (!d->coarse && d->from > 0.0)
        return tree_fail(s->file, fields_where(&d->part, "from"),
                         "from: only with coarse: what stays has come from the beginning on");
    return 0;
}

int scene_books_begin(scene *s) {
    const size_t groups = (size_t)s->groups;
    struct books *b = s->books = tree_memory(s->file, sizeof *b);
    if (!b || check_separation(s)) return -1;
    b->came = tree_memory(s->file, groups * sizeof *b->came);
    b->came_before = tree_memory(s->file, groups * sizeof *b->came);
    b->left = tree_memory(s->file, groups * (size_t)(s->world.walls + 1) * sizeof *b->left);
    b->left_before = tree_memory(s->file, groups * (size_t)(s->world.walls + 1) * sizeof *b->left);
    return b->came && b->came_before && b->left && b->left_before ? 0 : -1;
}

void scene_books_free(scene *s) {
    if (!s->books) return;
    free(s->books->born);
    free(s->books->gone);
    s->books->born = NULL, s->books->gone = NULL;
}

static int make_room(struct books *b, uint64_t ids) {
    if (ids <= b->room) return 0;
    const uint64_t room = 2 * b->room > ids ? 2 * b->room : ids;
    double *more = realloc(b->born, (size_t)room * sizeof *more);
    if (!more) return -1;
    for (uint64_t k = b->room; k < room; k++) more[k] = (double)NAN;
    b->born = more, b->room = room;
    return 0;
}

static void add(tally *t, double mass, double diameter, double cut, double age) {
    t->count += 1.0, t->mass += mass, t->sized += mass * diameter;
    t->under += diameter < cut ? mass : 0.0;
    t->aged += mass * age, t->aged2 += mass * age * age;
}

dem_status scene_books_come(scene *s, ptrdiff_t first) {
    struct books *b = s->books;
    const double now = s->world.time, cut = scene_cut(s);
    for (ptrdiff_t i = first; i < s->world.count; i++) {
        const uint64_t id = s->world.id[i];
        if (make_room(b, id + 1)) return DEM_OUT_OF_MEMORY;
        b->born[id] = now;
        b->ids = id + 1 > b->ids ? id + 1 : b->ids;
        const dem_body body = dem_get_body(&s->world, i);
        if (body.first == i) add(&b->came[s->world.group[i]], body.mass, body.diameter, cut, 0.0);
    }
    return DEM_OK;
}

void scene_books_leave(scene *s, const dem_passed *p, double mass) {
    struct books *b = s->books;
    const double age = p->id < b->ids ? p->time - b->born[p->id] : (double)NAN;
    add(&b->left[p->exit * s->groups + p->group], mass, p->diameter, scene_cut(s), age);
    if (!s->def->output.passed) return;
    if (b->left_count == b->left_room) {
        gone *more = realloc(b->gone, ((size_t)b->left_room * 2 + 256) * sizeof *more);
        if (!more) return;
        b->gone = more, b->left_room = b->left_room * 2 + 256;
    }
    const gone one = {p->time, age, p->diameter, mass, p->group, p->exit};
    b->gone[b->left_count++] = one;
}

void scene_books_look(scene *s, double now) {
    struct books *b = s->books;
    const double from = s->def->measure.separation.part.where ? s->def->measure.separation.from : 0.0;
    if (b->began > 0.0 || !(now >= from - 1e-9 * s->tick)) return;
    b->began = 1.0;
    memcpy(b->came_before, b->came, (size_t)s->groups * sizeof *b->came);
    memcpy(b->left_before, b->left, (size_t)s->groups * (size_t)s->world.walls * sizeof *b->left);
}

static void exchange_tallies(scene_state *io, tally *t, int n) {
    for (int k = 0; k < n; k++) {
        double v[6] = {t[k].count, t[k].mass, t[k].sized, t[k].under, t[k].aged, t[k].aged2};
        state_numbers(io, v, 6);
        t[k].count = v[0], t[k].mass = v[1], t[k].sized = v[2], t[k].under = v[3], t[k].aged = v[4], t[k].aged2 = v[5];
    }
}

static void exchange_gone(scene *s, scene_state *io) {
    struct books *b = s->books;
    double n = b->left_count;
    state_numbers(io, &n, 1);
    if (!(n >= 0.0 && n < 2e9)) io->failed = 1;
    if (io->reading) b->left_count = 0;
    for (int k = 0; k < n && !io->failed; k++) {
        if (io->reading && k == b->left_room) {
            gone *more = realloc(b->gone, ((size_t)b->left_room * 2 + 256) * sizeof *more);
            if (!more) io->failed = 1;
            else b->gone = more, b->left_room = b->left_room * 2 + 256;
        }
        if (io->failed) return;
        gone *g = &b->gone[k];
        double v[6] = {0.0};
        if (!io->reading)
            v[0] = g->time, v[1] = g->age, v[2] = g->diameter, v[3] = g->mass, v[4] = g->group, v[5] = g->exit;
        state_numbers(io, v, 6);
        if (!(v[4] >= 0.0 && v[4] < s->groups && v[5] >= 0.0 && v[5] < s->world.walls)) io->failed = 1;
        else
            g->time = v[0], g->age = v[1], g->diameter = v[2], g->mass = v[3], g->group = (int)v[4],
            g->exit = (int)v[5], b->left_count = k + 1;
    }
}

int scene_books_exchange(scene *s, scene_state *io) {
    struct books *b = s->books;
    uint64_t ids = b->ids;
    exchange_tallies(io, b->came, s->groups);
    exchange_tallies(io, b->came_before, s->groups);
    exchange_tallies(io, b->left, s->groups * s->world.walls);
    exchange_tallies(io, b->left_before, s->groups * s->world.walls);
    state_numbers(io, &b->began, 1);
    state_whole(io, &ids);
    if (io->reading && ids > (io->size - io->at) / 8) io->failed = 1;
    if (!io->failed && make_room(b, ids)) io->failed = 1;
    if (io->failed) return -1;
    b->ids = ids;
    state_numbers(io, b->born, (size_t)ids);
    exchange_gone(s, io);
    return io->failed ? -1 : 0;
}

const tally *scene_came(const scene *s, int group) { return &s->books->came[group]; }
const tally *scene_left(const scene *s, int wall, int group) { return &s->books->left[wall * s->groups + group]; }

static tally since(const tally *now, const tally *before, double began) {
    const tally none = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    const tally more = {now->count - before->count, now->mass - before->mass, now->sized - before->sized,
                        now->under - before->under, now->aged - before->aged, now->aged2 - before->aged2};
    return began > 0.0 ? more : none;
}
tally scene_came_since(const scene *s, int group) {
    return since(&s->books->came[group], &s->books->came_before[group], s->books->began);
}
tally scene_left_since(const scene *s, int wall, int group) {
    const int at = wall * s->groups + group;
    return since(&s->books->left[at], &s->books->left_before[at], s->books->began);
}

const gone *scene_gone(const scene *s, int *n) {
    *n = s->books->left_count;
    return s->books->gone;
}
