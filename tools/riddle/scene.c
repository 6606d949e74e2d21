/* scene.c: see scene.h */
#include "scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "scene_books.h"
#include "scene_feed.h"
#include "scene_laws.h"
#include "scene_shapes.h"
#include "scene_timetable.h"
#include "scene_walls.h"
#include "scene_wet.h"

enum { STEPS = 2000, STEPS_OF_A_MAP = 5 /* a hit lasts 20 */ };
static const double EXPECTED_SPEED = 2.0; /* [m/s] for Hertz contacts, as a fall of 0.2 m gives */

/* ---- definition ---- */

static int define_contacts(scene *s, dem_def *def) {
    const contact_def *c = s->def->contacts.item;
    int seen[DEM_MATERIALS_MAX][DEM_MATERIALS_MAX] = {{0}};
    for (int k = 0; k < s->def->contacts.n; k++, c++) {
        int a, b;
        if (scene_material(s->file, s->def, &c->part, "between", c->between[0], &a) ||
            scene_material(s->file, s->def, &c->part, "between", c->between[1], &b))
            return -1;
        if (seen[a < b ? a : b][a < b ? b : a]++)
            return tree_fail(s->file, c->part.where, "contact: %s and %s stand here a second time", c->between[0],
                             c->between[1]);
        dem_pair_def *p = dem_pair(def, a, b);
        p->stiffness = c->stiffness, p->tangential_ratio = c->tangential_ratio, p->restitution = c->restitution;
        p->friction = c->friction, p->rolling = c->rolling, p->tangential_damping = c->tangential_damping;
        p->mode = c->dashpot == 0 ? DEM_CLIPPED : DEM_NAIVE;
    }
    return 0;
}

static int find_features(const scene *s, const dem_def *def) {
    bool friction = false, rolling = false;
    for (int a = 0; a < def->materials; a++)
        for (int b = a; b < def->materials; b++)
            friction |= def->pair[a][b].friction > 0.0, rolling |= def->pair[a][b].rolling > 0.0;
    return (s->def->law == LAW_LINEAR ? DEM_LINEAR : DEM_HERTZ) | (friction || rolling ? DEM_FRICTION : 0) |
           (rolling ? DEM_ROLLING : 0);
}

/* Ctrl-C while feeds look for places. */
static int is_interrupted(void *user) {
    (void)user;
    return common_interrupted();
}

static int define(scene *s, dem_def *def) {
    const material_def *m = s->def->materials.item;
    const periodic_def *p = &s->def->periodic;
    const char *bad = "";
    *def = dem_default_def();
    def->allocator.fn = machine_resize;
    def->stop = is_interrupted;
    for (int k = 0; k < s->def->materials.n; k++)
        dem_add_material(def, m[k].density, m[k].young_modulus, m[k].poisson_ratio);
    if (define_contacts(s, def)) return -1;
    for (int c = 0; p->part.where && c < 3; c++) {
        if (!p->axis[c].part.where) continue;
        if (!(p->axis[c].low < p->axis[c].high))
            return tree_fail(s->file, p->axis[c].part.where, "periodic: %c: low must be below high", "xyz"[c]);
        def->periodic[c] = 1;
        *dem_axis_of(&def->low, c) = p->axis[c].low, *dem_axis_of(&def->high, c) = p->axis[c].high;
    }
    def->gravity = scene_vec(s->def->gravity);
    def->threads = s->threads;
    s->features = find_features(s, def);
    return dem_check_def(def, &bad) == DEM_OK ? 0 : tree_fail(s->file, s->file->root, "%s is outside its range", bad);
}

/* The step for the smallest particle that may come, against its like and against a wall of every material: asked of a
   world of such. A face of a polyhedron has down to a quarter of its mass on four springs, and its contacts begin and
   end uncorrected (docs/dem_convex.md). */
static int choose_step(scene *s, dem_def def, double *dt) {
    dem_world trial;
    *dt = s->def->time_step;
    if (!isnan(*dt)) return 0;
    def.periodic[0] = def.periodic[1] = def.periodic[2] = 0;
    dem_status status = dem_init(&trial, &def, NULL);
    double at = 0.0;
    for (int k = 0; k < def.materials && status == DEM_OK; k++)
        if (dem_add_plane(&trial, k, dem_vec3(0, 0, -1e6), dem_vec3(0, 0, 1)) < 0) status = DEM_TOO_MANY;
    for (int k = 0; k < s->sources && status == DEM_OK; k++) {
        double low, high;
        scene_extremes(&s->source[k], &low, &high);
        for (int twice = 0; twice < 2 && status == DEM_OK; twice++) {
            status = scene_put(&trial, &s->source[k], low, dem_vec3(at, 0.0, 0.0));
            at += 3.0 * high * (s->source[k].shape ? s->source[k].shape->reach : 1.0);
        }
    }
    if (status == DEM_OK)
        *dt = fmin(dem_advise(&trial, s->features, EXPECTED_SPEED).advised, scene_laws_step(s));
    dem_free(&trial);
    return status == DEM_OK && *dt > 0.0 && isfinite(*dt)
               ? 0
               : tree_fail(s->file, s->file->root, "no time step can be advised: give time_step");
}

/* Long enough for the largest particle that may come, as dem.h asks when it has come. */
static int check_periodic(scene *s) {
    const axis_def *axis = s->def->periodic.axis;
    for (int k = 0; k < s->sources; k++) {
        const source *q = &s->source[k];
        double smallest, largest;
        scene_extremes(q, &smallest, &largest);
        largest *= scene_widest(q->shape);
        for (int c = 0; c < 3; c++)
            if (axis[c].part.where && !(axis[c].high - axis[c].low > 2.2 * largest))
                return tree_fail(
                    s->file, axis[c].part.where,
                    "periodic: %c: %g mm long; above %.6g mm, 2.2 of the largest particles of %g mm, is wanted",
                    "xyz"[c], 1e3 * (axis[c].high - axis[c].low), 2.2e3 * largest, 1e3 * largest);
    }
    return 0;
}

static double smallest_of(const scene *s) {
    double smallest = HUGE_VAL, low, high;
    for (int k = 0; k < s->sources; k++) scene_extremes(&s->source[k], &low, &high), smallest = fmin(smallest, low);
    return smallest;
}

/* No longer than feeds allow, and than STEPS steps, so that Ctrl-C is heard. The duration has no part in it: a longer
   one has the same bits. */
static int choose_tick(scene *s) {
    const wall_def *w = s->def->walls.item;
    int mapped = 0;
    for (int k = 0; k < s->def->walls.n; k++) mapped |= w[k].load_map;
    double shortest = fmin(s->def->measure.every, (mapped ? STEPS_OF_A_MAP : STEPS) * s->world.def.dt);
    for (int k = 0; k < s->sources; k++)
        if (!isnan(s->source[k].def->rate)) shortest = fmin(shortest, scene_feed_interval(s, &s->source[k]));
    s->tick = s->def->measure.every / ceil(s->def->measure.every / shortest - 1e-9);
    const double ticks = s->def->duration / s->tick, steps = s->tick / s->world.def.dt;
    if (!(ticks < 1e9))
        return tree_fail(s->file, fields_where(&s->def->part, "duration"),
                         "duration: more than a thousand million ticks of %.3g s", s->tick);
    if (!(steps >= 1.0))
        return tree_fail(s->file, s->def->measure.part.where,
                         isnan(s->def->time_step)
                             ? "measure: every is below the time step of %.3g s for the smallest particles, of %.4g mm"
                             : "measure: every is below the time_step of %.3g s",
                         s->world.def.dt, 1e3 * smallest_of(s));
    return 0;
}

int scene_make(scene *s, const scene_def *def, tree_file *file, uint64_t seed, int threads) {
    dem_def d;
    memset(s, 0, sizeof *s);
    s->def = def, s->file = file, s->seed = seed, s->threads = threads;
    if (define(s, &d) || scene_make_shapes(s) || scene_add_sources(s) || scene_laws_begin(s)) return -1;
    if (scene_has_polyhedra(s))
        s->features |= DEM_FRICTION; /* what their contacts remember; without friction its coefficient is 0 */
    if (check_periodic(s) || choose_step(s, d, &d.dt)) return -1;
    const char *bad = "";
    if (dem_init(&s->world, &d, &bad) != DEM_OK) return tree_fail(file, file->root, "%s is outside its range", bad);
    return scene_add_shapes(s) || scene_add_walls(s) || scene_set_timetables(s) || choose_tick(s) ||
                   scene_books_begin(s) || scene_wet_begin(s)
               ? -1
               : 0;
}

void scene_free(scene *s) {
    dem_free(&s->world);
    scene_books_free(s);
    scene_wet_free(s);
    scene_laws_free(s);
}

/* ---- time ---- */

double scene_time(const scene *s) { return s->ticks * s->tick + s->beyond; }

/* Walls that are there for a part of the time only. */
static dem_status switch_walls(scene *s, double now) {
    const wall_def *w = s->def->walls.item;
    dem_status status = DEM_OK;
    for (int k = 0; k < s->def->walls.n && status == DEM_OK; k++) {
        const double soon = now + 1e-9 * s->tick;
        const int there = soon >= w[k].from && !(soon >= w[k].until);
        if (s->world.wall[s->wall_of[k]].enabled != there) status = dem_enable_wall(&s->world, s->wall_of[k], there);
    }
    return status;
}

static void book_passed(scene *s) {
    for (ptrdiff_t k = 0; k < s->world.passed_count; k++) {
        const dem_passed *p = &s->world.passed[k];
        size_group *g = &s->group[p->group];
        const double mass = g->density * RIDDLE_PI / 6.0 * p->diameter * p->diameter * p->diameter;
        g->passed += mass;
        s->exit_mass[p->exit] += mass;
        scene_books_leave(s, p, mass);
    }
    dem_take_passed(&s->world, NULL, s->world.passed_count);
}

static dem_status advance(scene *s, double next, double length) {
    const double now = scene_time(s);
    dem_status status = switch_walls(s, now);
    scene_books_look(s, now);
    if (status == DEM_OK) status = scene_follow_timetables(s, now + 0.5 * length);
    for (int k = 0; k < s->def->feeds.n && status == DEM_OK; k++) {
        const ptrdiff_t before = s->world.count;
        status = scene_feed(s, &s->feeder[k], now, next);
        if (status == DEM_OK) status = scene_books_come(s, before);
        if (status == DEM_OK) status = scene_wet_new(s, &s->feeder[k], before);
    }
    if (status == DEM_OK)
        status = s->wet    ? scene_wet_run(s, length)
                 : s->laws ? scene_laws_run(s, now, length)
                           : dem_run(&s->world, length, s->features);
    if (status != DEM_STOPPED) book_passed(s);
    return status;
}

dem_status scene_advance(scene *s) {
    const dem_status status = advance(s, (s->ticks + 1.0) * s->tick, s->tick);
    if (status == DEM_OK) s->ticks += 1.0;
    return status;
}

int scene_near_end(const scene *s, double *left) {
    *left = s->def->duration - scene_time(s);
    if (*left < 1e-6 * s->tick) *left = 0.0;
    return *left < (1.0 - 1e-6) * s->tick;
}

dem_status scene_finish(scene *s, double left) {
    const dem_status status = advance(s, s->def->duration, left);
    if (status == DEM_OK) s->beyond = left;
    return status;
}

scene_lack scene_missed(const scene *s) {
    scene_lack lack = {0.0, 0.0, 0.0, 0.0};
    for (int k = 0; k < s->sources; k++)
        lack.missed += (double)s->source[k].feed->missed, lack.missed_mass += s->source[k].feed->missed_mass;
    for (int k = 0; k < s->def->feeds.n; k++) {
        const scene_feeder *f = &s->feeder[k];
        double heaviest = 0.0;
        for (int c = 0; c < f->source.classes; c++) {
            double smallest, largest;
            scene_extremes(&f->first[c], &smallest, &largest);
            heaviest = fmax(heaviest, f->first[c].density * RIDDLE_PI / 6.0 * largest * largest * largest);
        }
        lack.asked += f->asked;
        if (f->source.due_mass > heaviest) lack.late += f->source.due_mass; /* a steady feed may owe half a particle */
    }
    return lack;
}

/* ---- saving ---- */

static void exchange_count(scene_state *io, ptrdiff_t *value) {
    uint64_t bits = (uint64_t)*value;
    state_whole(io, &bits);
    *value = (ptrdiff_t)bits;
}

static void exchange_feed(scene_state *io, source *q) {
    dem_feed *f = q->feed;
    double feed[] = {f->placed_mass, f->missed_mass, f->waiting};
    state_numbers(io, feed, sizeof feed / sizeof *feed);
    f->placed_mass = feed[0], f->missed_mass = feed[1], f->waiting = feed[2];
    exchange_count(io, &f->placed);
    exchange_count(io, &f->missed);
    state_whole(io, &f->random);
    state_whole(io, &f->waiting_of);
    if (q->shape) state_same(io, q->shape->diameter), state_same(io, q->shape->reach);
}

static void exchange_feeder(scene_state *io, scene_feeder *f) {
    double feed[] = {f->source.due, f->source.due_mass, f->done, f->asked};
    state_numbers(io, feed, sizeof feed / sizeof *feed);
    f->source.due = feed[0], f->source.due_mass = feed[1], f->done = feed[2], f->asked = feed[3];
}

static void exchange_world(scene *s, scene_state *io) {
    uint64_t size = io->reading ? 0 : dem_save(&s->world, NULL, 0);
    state_whole(io, &size);
    if (io->failed || (io->reading && size > io->size - io->at)) {
        io->failed = 1;
        return;
    }
    unsigned char *bytes = malloc((size_t)size + 1);
    if (!bytes) io->failed = 1;
    else if (!io->reading) dem_save(&s->world, bytes, (size_t)size);
    if (!io->failed) state_bytes(io, bytes, (size_t)size);
    if (io->reading && !io->failed) {
        dem_world loaded;
        if (dem_load(&loaded, bytes, (size_t)size, &s->world.def.allocator) != DEM_OK) io->failed = 1;
        else {
            loaded.def.stop = s->world.def.stop;
            dem_free(&s->world);
            s->world = loaded;
            s->world.def.threads = s->threads;
            if (scene_set_timetables(s)) io->failed = 1;
        }
    }
    free(bytes);
}

int scene_exchange(scene *s, scene_state *io) {
    state_same(io, s->tick);
    state_same(io, s->sources);
    state_same(io, s->groups);
    state_same(io, s->world.walls);
    state_same(io, s->wet ? 1.0 : 0.0);
    state_numbers(io, &s->ticks, 1);
    for (int k = 0; k < s->sources && !io->failed; k++) exchange_feed(io, &s->source[k]);
    for (int k = 0; k < s->def->feeds.n && !io->failed; k++) exchange_feeder(io, &s->feeder[k]);
    for (int k = 0; k < s->groups && !io->failed; k++)
        state_numbers(io, &s->group[k].fed, 1), state_numbers(io, &s->group[k].passed, 1);
    state_numbers(io, s->exit_mass, DEM_WALLS_MAX);
    if (!io->failed && scene_books_exchange(s, io)) io->failed = 1;
    if (s->wet && !io->failed && scene_wet_exchange(s, io)) io->failed = 1;
    if (!io->failed) exchange_world(s, io);
    if (io->reading && s->wet && !io->failed && scene_wet_link(s)) io->failed = 1;
    return io->failed ? -1 : 0;
}
