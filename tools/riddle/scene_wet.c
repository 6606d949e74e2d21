/* scene_wet.c: see scene_wet.h */
#include "dem_wet.h"

#include <math.h>
#include <stdlib.h>

#include "scene_feed.h"
#include "scene_wet.h"

/* Diameters of the classes that the tables of bridges are made for: the smallest, the largest, and between. */
static void classes_of(const scene *s, double *classes) {
    double low = HUGE_VAL, high = 0.0;
    for (int k = 0; k < s->sources; k++) {
        double a, b;
        scene_extremes(&s->source[k], &a, &b);
        low = fmin(low, a), high = fmax(high, b);
    }
    classes[0] = low, classes[1] = sqrt(low * high), classes[2] = high;
}

/* Room for all particles that will come, and about how much liquid they bring. */
static int room_of(const scene *s, double *volume) {
    double room = 1000.0;
    *volume = 0.0;
    for (int k = 0; k < s->def->feeds.n; k++) {
        const scene_feeder *f = &s->feeder[k];
        const feed_def *def = f->first->def;
        const double until = isnan(def->until) ? s->def->duration : fmin(def->until, s->def->duration);
        for (int c = 0; c < f->source.classes; c++) {
            const double number = scene_number_of(f, c, fmax(until - def->from, 0.0));
            room += 1.2 * number;
            *volume += number * f->first[c].film * RIDDLE_PI * f->first[c].square;
        }
    }
    return room < 2e7 ? (int)room : -1;
}

int scene_wet_begin(scene *s) {
    const liquid_def *l = &s->def->liquid;
    double classes[WET_CLASSES], volume;
    int decks = 0;
    if (!l->part.where) return 0;
    if (s->def->law != 0) return tree_fail(s->file, l->part.where, "liquid: only with law: linear");
    for (int k = 0; k < s->sources; k++)
        if (s->source[k].shape)
            return tree_fail(s->file, l->part.where, "liquid: only spheres can be wet, and a feed has the shape %.60s",
                             s->source[k].def->shape);
    for (int k = 0; k < s->world.walls; k++) decks += s->world.wall[k].kind == DEM_SCREEN;
    s->wet_room = room_of(s, &volume);
    if (s->wet_room < 0) return tree_fail(s->file, l->part.where, "liquid: more than 20 million particles");
    s->wet = calloc(1, sizeof *s->wet);
    s->wet_class = calloc((size_t)s->wet_room, sizeof *s->wet_class);
    if (!s->wet || !s->wet_class) return tree_fail(s->file, NULL, "out of memory");
    classes_of(s, classes);
    s->world.user = s->wet;
    bridge_status status =
        wet_prepare(s->wet, s->wet_room, s->wet_class, classes, volume, 0, decks, &s->world, false, l->wall_angle);
    s->wet->angle[0] = l->angle, s->wet->angle[1] = l->deck_angle;
    s->wet->liquid.surface_tension = l->surface_tension, s->wet->liquid.viscosity = l->viscosity;
    if (status == BRIDGE_OK) status = wet_prepare_kinds(s->wet, classes);
    return status == BRIDGE_OK ? 0 : tree_fail(s->file, l->part.where, "liquid: %s", bridge_status_text(status));
}

void scene_wet_free(scene *s) {
    if (s->wet) wet_free(s->wet);
    free(s->wet);
    free(s->wet_class);
    s->wet = NULL, s->wet_class = NULL;
}

dem_status scene_wet_new(scene *s, const scene_feeder *f, ptrdiff_t first) {
    double classes[WET_CLASSES];
    classes_of(s, classes);
    for (ptrdiff_t i = first; s->wet && i < s->world.count; i++) {
        const uint64_t id = s->world.id[i];
        const double d = 2.0 * s->world.particle[i].radius, film = f->first->film; /* equal on all of a feed */
        if (id >= (uint64_t)s->wet_room) return DEM_TOO_MANY;
        int nearest = 0; /* by ratio */
        for (int c = 1; c < WET_CLASSES; c++)
            if (fabs(log(d / classes[c])) < fabs(log(d / classes[nearest]))) nearest = c;
        s->wet_class[id] = nearest;
        s->wet->films.particle[id] = bridge_quantised(film * RIDDLE_PI * d * d, s->wet->films.quantum);
        s->liquid += s->wet->films.particle[id];
    }
    return DEM_OK;
}

dem_status scene_wet_run(scene *s, double duration) { return wet_run(&s->world, duration, 0); }

double scene_wet_total(const scene *s, int *bridges) {
    double volume = wet_total(s->wet, &s->world, bridges) - bridge_films_total(&s->wet->films); /* in bridges */
    for (ptrdiff_t i = 0; i < s->world.count; i++)
        if (s->world.alive[i]) volume += s->wet->films.particle[s->world.id[i]];
    for (size_t k = 0; k < s->wet->films.n_patches; k++) volume += s->wet->films.patch[k];
    return volume;
}

int scene_wet_exchange(scene *s, scene_state *io) {
    wet_scene *w = s->wet;
    uint64_t used = (uint64_t)s->wet_room, patches = w->films.n_patches, ruptures = (uint64_t)w->ruptures;
    state_whole(io, &used);
    state_whole(io, &patches);
    state_whole(io, &ruptures);
    if (io->failed || used > (uint64_t)s->wet_room || patches != w->films.n_patches) return io->failed = 1, -1;
    state_numbers(io, &w->films.quantum, 1);
    state_numbers(io, w->films.particle, (size_t)used);
    state_numbers(io, w->films.patch, w->films.n_patches);
    for (uint64_t k = 0; k < used; k++) {
        uint64_t class = (uint64_t)s->wet_class[k];
        state_whole(io, &class);
        if (class >= WET_CLASSES) return io->failed = 1, -1;
        s->wet_class[k] = (int)class;
    }
    w->ruptures = (long long)ruptures;
    state_numbers(io, &s->liquid, 1);
    return io->failed ? -1 : 0;
}

int scene_wet_link(scene *s) {
    s->world.user = s->wet;
    return dem_set_links(&s->world, &wet_link_kernel, WET_INTERVAL, WET_NEAR) == DEM_OK ? 0 : -1;
}
