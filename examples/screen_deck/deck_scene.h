/* deck_scene.h - a vibrated, inclined screen of one to three decks under a steady feed: a section of its width between
   periodic sides.

   The frame lies in the deck: x along it, downhill, y across, z away from it, z = 0 in the plane of the first deck's
   wires; gravity is inclined instead. Decks, one above another, and the plate at their upper end vibrate as one body
   along a line, a circle or an ellipse. What passes x = length has left over the end of the deck below it, what has
   fallen through the last deck is the underflow. */
#ifndef DECK_SCENE_H
#define DECK_SCENE_H

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "machine.h"
#include "dem_wet.h"

enum { DECKS_MAX = 3 };
typedef enum deck_mesh { DECK_SQUARE, DECK_SLOTS_ALONG, DECK_SLOTS_ACROSS } deck_mesh;

/* The machine and its feed, SI units, per section of its width. */
typedef struct deck_def {
    int decks, mesh;                             /* 1 .. DECKS_MAX; deck_mesh */
    double aperture[DECKS_MAX], wire[DECKS_MAX]; /* clear width of square holes or slots; of round wires or flat
                                                    bars [m] > 0 */
    double slot_length;                          /* clear length of slots between cross bars [m] >= 0; 0: none */
    double length, width, spacing;               /* of a deck, of the section, between decks [m] > 0 */
    double inclination;                          /* downhill [rad] 0 .. 0.8 */
    double amplitude, minor;                     /* half axes of the ellipse [m] >= 0; minor < 0: the deck runs
                                                    uphill at the top */
    double direction, frequency;                 /* of the major axis against the deck [rad]; [Hz] > 0 */
    double flow;                                 /* [kg/s] > 0 */
    dem_sizes sizes;
    double density, stiffness, friction, restitution, rolling; /* of the grains; contacts [N/m], [-], [-],
                                                                  lever arm [m] */
    double moisture;                                           /* mass of water over mass of grains [-] */
    double drop, feed_length;                                  /* height of fall onto the deck, length of the feed's
                                                                  place [m] > 0 */
    double steps_per_contact, longest;                         /* [-] >= 8; simulated time that is not exceeded [s] */
    uint64_t seed;
    int threads;
} deck_def;

static inline deck_def deck_default(void) {
    deck_def d;
    memset(&d, 0, sizeof d);
    d.decks = 1;
    d.aperture[0] = 0.010, d.aperture[1] = 0.0063, d.aperture[2] = 0.004;
    d.wire[0] = 0.0025, d.wire[1] = 0.002, d.wire[2] = 0.0015;
    d.length = 1.2, d.width = 0.075, d.spacing = 0.15;
    d.inclination = 12.0 / 180.0 * RIDDLE_PI;
    d.amplitude = 0.004, d.direction = 0.25 * RIDDLE_PI, d.frequency = 16.0;
    d.flow = 1.0;
    d.sizes = dem_rosin_rammler_sizes(0.011, 2.2, 0.004, 0.020, 1);
    d.density = 2650.0, d.stiffness = 5e4, d.friction = 0.5, d.restitution = 0.4, d.rolling = 3e-4;
    d.drop = 0.10, d.feed_length = 0.10;
    d.steps_per_contact = 8.0, d.longest = 60.0;
    d.seed = 1, d.threads = 1;
    return d;
}

static inline double deck_pitch(const deck_def *d, int k) { return d->aperture[k] + d->wire[k]; }
static inline double deck_height(const deck_def *d, int k) { return -k * d->spacing; } /* of its plane [m] */
static inline double deck_largest(const dem_sizes *s) {
    double most = s->kind == DEM_SIZES_LIST ? 0.0 : s->largest;
    for (int k = 0; k < s->count && s->kind == DEM_SIZES_LIST; k++)
        if (s->share[k] > 0.0) most = fmax(most, s->diameter[k]);
    return most;
}
static inline double deck_smallest(const dem_sizes *s) {
    double least = s->kind == DEM_SIZES_LIST ? HUGE_VAL : s->smallest;
    for (int k = 0; k < s->count && s->kind == DEM_SIZES_LIST; k++)
        if (s->share[k] > 0.0) least = fmin(least, s->diameter[k]);
    return least;
}

/* Makes width and length whole numbers of pitches, as holes are not to be cut by the sides or the ends: the width to
   the nearest that holds three of the largest grains, the length to an odd number. Wires of lower decks get the width
   with which their pitch divides the section. NULL, or the name of the field that cannot be. */
static inline const char *deck_round(deck_def *d) {
    const double pitch = deck_pitch(d, 0), most = deck_largest(&d->sizes);
    if (!(d->aperture[0] > 0.0 && d->wire[0] > 0.0)) return "aperture";
    if (!(most > 0.0 && most < 1.0 && deck_smallest(&d->sizes) > 0.0)) return "sizes";
    if (!(d->width > 0.0 && d->width < 2000.0 * pitch)) return "width";
    if (!(d->length > 0.0 && d->length < 20000.0 * pitch)) return "length";
    d->width = pitch * fmax(floor(d->width / pitch + 0.5), ceil(3.0 * most / pitch));
    d->length = pitch * (2.0 * floor(fmax(0.5 * (d->length / pitch - 1.0), 0.0) + 0.5) + 1.0);
    if (!(d->feed_length + 2.0 * most < d->length)) return "length";
    for (int k = 1; k < d->decks; k++) {
        const double own = d->width / floor(d->width / deck_pitch(d, k) + 0.5);
        if (!(d->aperture[k] > 0.0 && d->wire[k] > 0.0 && d->aperture[k] < d->aperture[k - 1] && own > d->aperture[k]))
            return "aperture";
        d->wire[k] = own - d->aperture[k];
    }
    return d->decks == 1 || d->spacing > 2.0 * most + 4.0 * d->amplitude ? NULL : "spacing";
}

/* The ellipse as amplitude and phase of each component: along its major axis A sin, across it B cos of 2 pi f t. */
static inline void deck_motion(const deck_def *d, dem_vec *amplitude, dem_vec *phase) {
    const double c = cos(d->direction), s = sin(d->direction), a = d->amplitude, b = d->minor;
    *amplitude = dem_vec3(hypot(a * c, b * s), 0.0, hypot(a * s, b * c));
    *phase = dem_vec3(atan2(-b * s, a * c), 0.0, atan2(b * c, a * s));
}

/* Peak acceleration perpendicular to the deck over gravity's component (toss indicator K) [-]. */
static inline double deck_toss(const deck_def *d) {
    const double turn = 2.0 * RIDDLE_PI * d->frequency;
    return hypot(d->amplitude * sin(d->direction), d->minor * cos(d->direction)) * turn * turn /
           (9.81 * cos(d->inclination));
}

typedef struct deck_machine {
    deck_def def;
    dem_world world;
    dem_feed feed;
    double step; /* between two feedings [s] */
    wet_scene *wet;
    int *group;          /* of wet grains by id */
    double film, liquid; /* water a surface of grains [m], fed so far [m3] */
} deck_machine;

/* ---- bars of slots, as a mesh of triangles ---- */

/* A bar between two points, flat on top, tapering downwards: `across` is half its width, at right angles to its run. */
static inline void deck_add_bar(dem_mesh *m, dem_vec from, dem_vec to, dem_vec across, double depth) {
    static const int32_t corner[8][3] = {{0, 1, 3}, {0, 3, 2}, {0, 4, 5}, {0, 5, 1},
                                         {2, 3, 5}, {2, 5, 4}, {0, 2, 4}, {1, 5, 3}};
    const dem_vec v[6] = {{from.x - across.x, from.y - across.y, from.z},
                          {to.x - across.x, to.y - across.y, to.z},
                          {from.x + across.x, from.y + across.y, from.z},
                          {to.x + across.x, to.y + across.y, to.z},
                          {from.x, from.y, from.z - depth},
                          {to.x, to.y, to.z - depth}};
    for (int q = 0; q < 8; q++)
        for (int c = 0; c < 3; c++) m->triangle[3 * (m->triangles + q) + c] = (int32_t)m->vertices + corner[q][c];
    for (int q = 0; q < 6; q++) {
        double *at = &m->vertex[3 * (m->vertices + q)];
        at[0] = v[q].x, at[1] = v[q].y, at[2] = v[q].z;
    }
    m->vertices += 6, m->triangles += 8;
}

/* Bars of one run, along x or y at a pitch, from `first` to `end` of the other axis, in pieces, as a search in short
   ones is quicker. */
static inline void deck_add_bars(dem_mesh *m, bool along, double first, double end, double pitch, double low,
                                 double high, double wire, double z, double piece) {
    const int pieces = (int)ceil((high - low) / piece - 1e-9);
    for (int b = 0; first + b * pitch <= end + 1e-9; b++)
        for (int q = 0; q < pieces; q++) {
            const double at = first + b * pitch, from = low + (high - low) * q / pieces,
                         to = low + (high - low) * (q + 1) / pieces;
            deck_add_bar(m, along ? dem_vec3(from, at, z) : dem_vec3(at, from, z),
                         along ? dem_vec3(to, at, z) : dem_vec3(at, to, z),
                         along ? dem_vec3(0.0, 0.5 * wire, 0.0) : dem_vec3(0.5 * wire, 0.0, 0.0), 1.5 * wire);
        }
}

/* A grain in flight may be several widths beyond the sides until it lands: walls reach that far. */
enum { DECK_BEYOND = 3 };

static inline int deck_add_slots(deck_machine *k, int material, int number) {
    const deck_def *d = &k->def;
    const bool along = d->mesh == DECK_SLOTS_ALONG;
    const double wire = d->wire[number], pitch = deck_pitch(d, number), other = d->slot_length + wire,
                 z = deck_height(d, number);
    const double side[2] = {-DECK_BEYOND * d->width, (1 + DECK_BEYOND) * d->width},
                 end[2] = {-0.5 * wire, d->length + 0.5 * wire};
    /* Bars run, and stand in a row. */
    const double *run = along ? end : side, *row = along ? side : end, piece = 8.0 * pitch;
    const double runs = (row[1] - row[0]) / pitch + 2.0,
                 cross = d->slot_length > 0.0 ? (run[1] - run[0]) / other + 2.0 : 0.0;
    const double many = runs * ((run[1] - run[0]) / piece + 1.0) + cross * ((row[1] - row[0]) / piece + 1.0);
    if (!(many < 1e6)) return -(int)DEM_BAD_ARGUMENT;
    dem_mesh m;
    memset(&m, 0, sizeof m);
    m.vertex = malloc((size_t)many * 18 * sizeof *m.vertex);
    m.triangle = malloc((size_t)many * 24 * sizeof *m.triangle);
    int wall = -(int)DEM_OUT_OF_MEMORY;
    if (m.vertex && m.triangle) {
        deck_add_bars(&m, along, along ? row[0] : 0.0, row[1], pitch, run[0], run[1], wire, z, piece);
        if (d->slot_length > 0.0)
            deck_add_bars(&m, !along, along ? 0.0 : run[0], run[1], other, row[0], row[1], wire, z, piece);
        wall = dem_add_mesh(&k->world, material, &m);
    }
    free(m.vertex);
    free(m.triangle);
    return wall;
}

static inline int deck_add_wires(deck_machine *k, int material, int number) {
    const deck_def *d = &k->def;
    const double pitch = deck_pitch(d, number);
    const int across = (int)(d->width / pitch + 0.5), along = 2 * (int)ceil(0.5 * (d->length / pitch - 1.0) - 1e-9) + 1;
    dem_screen screen = dem_default_screen();
    screen.aperture = d->aperture[number], screen.wire = d->wire[number], screen.profile = DEM_ROUND;
    screen.circular = 0;
    screen.half_x = 0.5 * along * pitch, screen.half_y = (DECK_BEYOND * across + 0.5) * pitch;
    screen.centre = dem_vec3(screen.half_x, (across / 2 + 0.5) * pitch, deck_height(d, number));
    return dem_add_screen(&k->world, material, &screen);
}

/* ---- the machine ---- */

/* Water: a film of equal thickness on every grain, none on walls. Grains have a class of size for the
   tables of bridges. */
static inline dem_status deck_add_liquid(deck_machine *k) {
    enum { DRAWS = 20000 };
    const deck_def *d = &k->def;
    const double small = deck_smallest(&d->sizes), most = deck_largest(&d->sizes);
    const double classes[WET_CLASSES] = {small, sqrt(small * most), most};
    uint64_t random = 1;
    double square = 0.0, cube = 0.0;
    for (int i = 0; i < DRAWS; i++) {
        const double x = dem_draw_size(&d->sizes, &random);
        square += x * x / DRAWS, cube += x * x * x / DRAWS;
    }
    k->film = d->moisture * d->density / 1000.0 * cube / (6.0 * square);
    const double grains = 1.2 * d->flow * d->longest / (d->density * RIDDLE_PI / 6.0 * cube) + 1000.0;
    if (!(grains < 1e8)) return DEM_TOO_MANY;
    const int room = (int)grains;
    k->wet = malloc(sizeof *k->wet);
    k->group = calloc((size_t)room, sizeof *k->group);
    if (!k->wet || !k->group) return DEM_OUT_OF_MEMORY;
    k->world.user = k->wet;
    return wet_prepare(k->wet, room, k->group, classes, k->film * RIDDLE_PI * square * room, 0, d->decks, &k->world,
                       false, WET_STEEL) == BRIDGE_OK
               ? DEM_OK
               : DEM_BAD_ARGUMENT;
}

static inline void deck_free(deck_machine *k) {
    dem_free(&k->world);
    if (k->wet) wet_free(k->wet);
    free(k->wet);
    free(k->group);
    memset(k, 0, sizeof *k);
}

static inline dem_status deck_add_walls(deck_machine *k, int steel) {
    const deck_def *d = &k->def;
    dem_vec amplitude, phase;
    dem_status status = DEM_OK;
    deck_motion(d, &amplitude, &phase);
    /* wall q is deck q, the last the plate at the upper end */
    for (int q = 0; q <= d->decks && status == DEM_OK; q++) {
        const int wall = q == d->decks ? dem_add_plane(&k->world, steel, dem_vec3(0, 0, 0), dem_vec3(1, 0, 0))
                         : d->mesh == DECK_SQUARE ? deck_add_wires(k, steel, q)
                                                  : deck_add_slots(k, steel, q);
        status = wall < 0 ? (dem_status)-wall : dem_vibrate(&k->world, wall, amplitude, phase, d->frequency);
    }
    const double low =
        deck_height(d, d->decks - 1) - 1.5 * deck_largest(&d->sizes) - 2.0 * fmax(d->amplitude, fabs(d->minor));
    if (status == DEM_OK && (dem_add_exit(&k->world, dem_vec3(d->length, 0, 0), dem_vec3(-1, 0, 0)) < 0 ||
                             dem_add_exit(&k->world, dem_vec3(0, 0, low), dem_vec3(0, 0, 1)) < 0))
        status = DEM_TOO_MANY;
    return status;
}

static inline void deck_place_feed(deck_machine *k) {
    const deck_def *d = &k->def;
    const double most = deck_largest(&d->sizes), speed = sqrt(2.0 * 9.81 * 0.5 * d->drop),
                 bottom = 0.5 * d->drop + 0.5 * d->wire[0];
    /* Of its height, at a solid share of a tenth. */
    const double need = d->flow / (0.1 * d->density * d->feed_length * d->width * speed);
    const double height = fmax(1.5 * most, 0.01 * speed * fmax(need, 1.0));
    k->feed = dem_default_feed();
    k->feed.region = dem_box_region(dem_vec3(1.1 * most, 0.0, bottom),
                                    dem_vec3(1.1 * most + d->feed_length, d->width, bottom + height));
    k->feed.sizes = d->sizes;
    k->feed.velocity = dem_vec3(0.3 * speed, 0.0, -speed);
    k->feed.scatter = dem_vec3(0.1 * speed, 0.1 * speed, 0.1 * speed);
    k->feed.random = d->seed * 1000003u + 1u;
    k->step = 0.01;
}

/* The empty machine, running. The definition is one that deck_round() has taken. Free with deck_free, also
   after a failure. */
static inline dem_status deck_make(deck_machine *k, const deck_def *given) {
    const deck_def *d = &k->def;
    memset(k, 0, sizeof *k);
    k->def = *given;
    dem_def def = dem_default_def();
    def.allocator.fn = machine_resize;
    const int stone = dem_add_material(&def, d->density, 5e10, 0.25),
              steel = dem_add_material(&def, 7850.0, 2.08e11, 0.3);
    for (int q = 0; q < 2; q++) {
        dem_pair_def *pair = dem_pair(&def, stone, q ? steel : stone);
        pair->stiffness = d->stiffness, pair->friction = d->friction, pair->restitution = d->restitution,
        pair->rolling = d->rolling;
    }
    const double unit = d->density * RIDDLE_PI / 6.0, small = deck_smallest(&d->sizes);
    def.gravity = dem_vec3(9.81 * sin(d->inclination), 0.0, -9.81 * cos(d->inclination));
    def.periodic[1] = 1, def.high.y = d->width;
    def.threads = d->threads;
    def.dt = dem_contact_time(d->stiffness, 0.5 * unit * small * small * small,
                              dem_damping_ratio(d->restitution, DEM_CLIPPED), DEM_CLIPPED) /
             d->steps_per_contact;
    dem_status status = dem_init(&k->world, &def, NULL);
    if (status == DEM_OK) status = deck_add_walls(k, steel);
    deck_place_feed(k);
    if (status == DEM_OK && d->moisture > 0.0) status = deck_add_liquid(k);
    return status;
}

/* Feeds what falls due in one step and runs it. */
static inline dem_status deck_advance(deck_machine *k) {
    const int features = DEM_LINEAR | DEM_FRICTION | (k->def.rolling > 0.0 ? DEM_ROLLING : 0);
    const ptrdiff_t before = k->feed.placed;
    dem_status status = dem_feed_mass(&k->world, &k->feed, k->def.flow, k->step);
    if (status == DEM_OK && k->wet) {
        if ((size_t)k->feed.placed > k->wet->films.n_particles) return DEM_TOO_MANY;
        const double small = deck_smallest(&k->def.sizes), most = deck_largest(&k->def.sizes);
        for (ptrdiff_t i = k->world.count - (k->feed.placed - before); i < k->world.count; i++) {
            const double x = 2.0 * dem_radius(&k->world, i), water = k->film * RIDDLE_PI * x * x;
            const uint64_t id = k->world.id[i];
            k->group[id] = (int)fmin(
                fmax(WET_CLASSES * log(x / small) / log(most / small * (1.0 + 1e-12) + 1e-12), 0.0), WET_CLASSES - 1.0);
            k->wet->films.particle[id] = bridge_quantised(water, k->wet->films.quantum);
            k->liquid += k->wet->films.particle[id];
        }
    }
    if (status != DEM_OK) return status;
    return k->wet ? wet_run(&k->world, k->step, 0) : dem_run(&k->world, k->step, features);
}

#endif
