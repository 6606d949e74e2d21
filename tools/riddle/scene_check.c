/* scene_check.c: see scene_check.h */
#include "scene_check.h"

#include "scene_feed.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene_shapes.h"
#include "scene_walls.h"

/* Particle-steps per second on one core, of spheres in a bed with friction and of bodies of many contacts; bytes of a
   particle in a bed: benchmarks/README.md. Scenes differ by a factor of three. */
static const double SPHERES_PER_SECOND = 1e7, BODIES_PER_SECOND = 5e5, BYTES = 2400.0;

/* A material of the scene by its number, -1 where it is unknown. */
static int number_of(const scene *s, const char *name) {
    const material_def *m = s->def->materials.item;
    for (int k = 0; name && k < s->def->materials.n; k++)
        if (strcmp(m[k].part.name, name) == 0) return k;
    return -1;
}

static int has_contact(const scene *s, int a, int b) {
    const contact_def *c = s->def->contacts.item;
    for (int k = 0; k < s->def->contacts.n; k++) {
        const int one = number_of(s, c[k].between[0]), other = number_of(s, c[k].between[1]);
        if ((one == a && other == b) || (one == b && other == a)) return 1;
    }
    return 0;
}

int scene_lacks_contact(const scene *s, char *line, size_t size) {
    const material_def *m = s->def->materials.item;
    const feed_def *feed = s->def->feeds.item;
    const wall_def *wall = s->def->walls.item;
    for (int k = 0; k < s->def->feeds.n; k++) {
        const int a = number_of(s, feed[k].material);
        for (int other = k + 1; a >= 0 && other < s->def->feeds.n; other++) {
            const int b = number_of(s, feed[other].material);
            if (b < 0 || b == a || has_contact(s, a, b)) continue;
            snprintf(line, size, "%s and %s may meet (feeds %d and %d): how, is not said under contacts",
                     m[a].part.name, m[b].part.name, k + 1, other + 1);
            return 1;
        }
        for (int w = 0; a >= 0 && w < s->def->walls.n; w++) {
            const int b = wall[w].exit.part.where ? -1 : number_of(s, wall[w].material);
            if (b < 0 || b == a || has_contact(s, a, b)) continue;
            snprintf(line, size, "%s and %s may meet (feed %d and wall %s): how, is not said under contacts",
                     m[a].part.name, m[b].part.name, k + 1, wall[w].part.name);
            return 1;
        }
    }
    return 0;
}

/* Of one source over the whole run. */
static double particles_of(const scene *s, const source *q) {
    const feed_def *d = q->def;
    const scene_feeder *f = &s->feeder[d - (const feed_def *)s->def->feeds.item];
    const double end = isnan(d->until) ? s->def->duration : fmin(d->until, s->def->duration),
                 begin = isnan(d->from) ? 0.0 : d->from;
    return scene_number_of(f, (int)(q - f->first), fmax(end - begin, 0.0));
}

scene_size scene_estimate(const scene *s) {
    scene_size z = {0.0, s->def->duration / s->world.def.dt, 0.0, 0.0};
    double cost = 0.0;
    for (int k = 0; k < s->sources; k++) {
        const double n = particles_of(s, &s->source[k]);
        const int parts = scene_pieces(s->source[k].shape);
        const int polyhedra = scene_is_polyhedron(s->source[k].shape);
        /* what comes steadily is half there on average */
        const double present = n * parts * (isnan(s->source[k].def->rate) ? 1.0 : 0.5);
        z.particles += n * parts;
        cost += present / (polyhedra ? BODIES_PER_SECOND : SPHERES_PER_SECOND);
    }
    z.seconds = cost * z.steps;
    z.bytes = z.particles * BYTES;
    return z;
}

void scene_say_size(const scene_size *z, char *text, size_t length) {
    char time[40];
    if (z->seconds < 90.0) snprintf(time, sizeof time, "%.2g s", z->seconds);
    else if (z->seconds < 5400.0) snprintf(time, sizeof time, "%.2g min", z->seconds / 60.0);
    else if (z->seconds < 172800.0) snprintf(time, sizeof time, "%.2g h", z->seconds / 3600.0);
    else snprintf(time, sizeof time, "%.2g days", z->seconds / 86400.0);
    snprintf(text, length, "about %.2g particles, %.2g steps: %s on one core, within a factor of three; %.2g MB",
             z->particles, z->steps, time, 1e-6 * z->bytes);
}
