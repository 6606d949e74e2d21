/* sieve_patch.h - the blocking test of Lawinska, Modrzewski & Wodzinski (2016), section 2.1, by dem.h: a periodic patch
   of a woven sieve, a thin layer of spheres laid on it, vibrated, and free holes counted while the vibrator is off. */
#ifndef SIEVE_PATCH_H
#define SIEVE_PATCH_H

#include <stdlib.h>

#include "dem.h"
#include "machine.h"

typedef struct sieve_patch_def {
    int across;            /* apertures along each side >= 6 */
    double opening, wire;  /* l, width of the round wires [m] > 0 */
    double K, frequency;   /* toss indicator [-] >= 0 and frequency [Hz] > 0 of a vibration perpendicular
                              to the sieve */
    double slope;          /* of the sieve against the horizontal [rad] 0 .. 0.8; grains that slide out at one side come
                              in at the other */
    int circular;          /* 1: the vibration is a circle in the plane of the slope, at its top downhill */
    int refill;            /* 1: for each grain that passed an equal one is laid on top, so that load and mixture
                              stay as they are */
    double x_h;            /* mass share of grains of 0.8 l .. 1.2 l [-] 0 .. 1; the rest half 0.5 .. 0.8 l,
                              half 1.2 .. 1.6 l */
    double load;           /* of the sieve [kg/m2] > 0 */
    double density;        /* of the grains [kg/m3] > 0 */
    double friction;       /* grain on grain and grain on wire [-] >= 0 */
    double restitution[2]; /* grain on grain, grain on wire [-] */
    double overlap;        /* of a grain of size l that hits a wire at the speed of the deck and 0.1 m/s, over l [-]:
                              sets the stiffness */
    uint64_t seed;
    int threads;
} sieve_patch_def;

static inline sieve_patch_def sieve_patch_default(void) {
    sieve_patch_def def;
    memset(&def, 0, sizeof def);
    def.across = 20;
    def.opening = 1e-3, def.wire = 0.5e-3;
    def.K = 1.5, def.frequency = 70.0 / 3.0;
    def.x_h = 0.65;
    def.load = 1.0;
    def.density = 2600.0;
    def.friction = 0.3;
    def.restitution[0] = 0.7, def.restitution[1] = 0.6;
    def.overlap = 0.01;
    def.seed = 1;
    def.threads = 1;
    return def;
}

typedef struct sieve_patch {
    sieve_patch_def def;
    dem_world world;
    int deck;
    ptrdiff_t grains;       /* laid on at the start */
    ptrdiff_t forced;       /* larger than a hole, of those that passed and were replaced, with refill */
    uint64_t random;        /* of the places where they are laid */
    double mass, hard_mass; /* of all, of hard-to-screen grains [kg] */
} sieve_patch;

static inline double sieve_patch_amplitude(const sieve_patch_def *d) { /* [m] */
    const double turn = 2.0 * RIDDLE_PI * d->frequency;
    return d->K * 9.81 * cos(d->slope) / (turn * turn);
}

/* The step for the grains that are left: those that pass are the smallest. */
static inline void sieve_patch_set_step(sieve_patch *patch) {
    dem_set_time_step(&patch->world, dem_advise(&patch->world, DEM_LINEAR | DEM_FRICTION, 0.1).advised);
}

/* The empty sieve, at rest. Free with dem_free(&patch->world), also after a failure. */
static inline dem_status sieve_patch_make(sieve_patch *patch, const sieve_patch_def *given) {
    const sieve_patch_def *d = &patch->def;
    memset(patch, 0, sizeof *patch);
    patch->def = *given;
    const double l = d->opening, pitch = l + d->wire, side = d->across * pitch,
                 speed = sieve_patch_amplitude(d) * 2.0 * RIDDLE_PI * d->frequency;
    const double unit = RIDDLE_PI / 6.0 * l * l * l * d->density, share = (speed + 0.1) / (d->overlap * l);
    if (!(unit > 0.0 && share > 0.0 && d->wire > 0.0 && d->load > 0.0 && unit + share + d->load + side < HUGE_VAL))
        return DEM_BAD_ARGUMENT;
    if (d->across < 6 || d->across > 1000 || !(d->x_h >= 0.0 && d->x_h <= 1.0) || !(d->slope >= 0.0 && d->slope <= 0.8))
        return DEM_BAD_ARGUMENT;
    dem_def def = dem_default_def();
    def.allocator.fn = machine_resize;
    def.gravity = dem_vec3(9.81 * sin(d->slope), 0.0, -9.81 * cos(d->slope));
    const int grain = dem_add_material(&def, d->density, 5e10, 0.25), steel = dem_add_material(&def, 7800.0, 2e11, 0.3);
    for (int k = 0; k < 2; k++) {
        dem_pair_def *pair = dem_pair(&def, grain, k ? steel : grain);
        pair->stiffness = (k ? 1.0 : 0.5) * unit * share * share; /* contacts of equal duration */
        pair->friction = d->friction;
        pair->restitution = d->restitution[k];
    }
    /* Whole pitches; the sides run over the middle of bars, so that no hole is cut. */
    def.periodic[0] = def.periodic[1] = 1;
    def.high = dem_vec3(side, side, 1.0);
    def.threads = d->threads;
    dem_status status = dem_init(&patch->world, &def, NULL);
    if (status != DEM_OK) return status;
    dem_screen screen = dem_default_screen();
    screen.aperture = l, screen.wire = d->wire, screen.profile = DEM_ROUND;
    screen.circular = 0;
    /* a grain's place is wrapped when it lands, and may be far out by then */
    screen.half_x = screen.half_y = 3.0 * side;
    screen.centre = dem_vec3(0.5 * pitch, 0.5 * pitch, 0.0);
    patch->deck = dem_add_screen(&patch->world, steel, &screen);
    if (patch->deck < 0) return (dem_status)-patch->deck;
    const int below = dem_add_exit(&patch->world, dem_vec3(0.0, 0.0, -3.0 * l - 2.0 * sieve_patch_amplitude(d)),
                                   dem_vec3(0.0, 0.0, 1.0));
    return below < 0 ? (dem_status)-below : DEM_OK;
}

/* Ends of the three kinds of grains over the opening: fine, hard to screen, coarse; in each, masses are even over
   the diameter. */
static const double sieve_patch_ends[4] = {0.5, 0.8, 1.2, 1.6};

static inline double sieve_patch_share(const sieve_patch_def *d, int kind) {
    return kind == 1 ? d->x_h : 0.5 - 0.5 * d->x_h;
} /* of the mass */

/* Number of grains that sieve_patch_lay lays on, on average. */
static inline double sieve_patch_expected(const sieve_patch_def *d) {
    const double side = d->across * (d->opening + d->wire),
                 unit = 6.0 / (RIDDLE_PI * d->density * d->opening * d->opening * d->opening);
    double number = 0.0;
    for (int k = 0; k < 3; k++) {
        const double a = sieve_patch_ends[k], b = sieve_patch_ends[k + 1];
        number += sieve_patch_share(d, k) * (1.0 / (a * a) - 1.0 / (b * b)) / (2.0 * (b - a));
    }
    return d->load * side * side * unit * number;
}

/* Lays the grains on, lets them come to rest, and makes the deck ready to vibrate. */
static inline dem_status sieve_patch_lay(sieve_patch *patch) {
    const sieve_patch_def *d = &patch->def;
    const double l = d->opening, side = d->across * (l + d->wire), mass = d->load * side * side, low = 0.5 * d->wire;
    const double height = d->load / (0.2 * d->density) + 3.2 * l;
    dem_status status = DEM_OK;
    for (int k = 2; k >= 0 && status == DEM_OK; k--) {
        dem_feed feed = dem_default_feed();
        feed.region = dem_box_region(dem_vec3(0.0, 0.0, low), dem_vec3(side, side, low + height));
        feed.sizes = dem_uniform_sizes(sieve_patch_ends[k] * l, sieve_patch_ends[k + 1] * l, 1);
        feed.group = k;
        feed.random = 3 * d->seed + (uint64_t)k;
        status = dem_fill_mass(&patch->world, &feed, mass * sieve_patch_share(d, k));
        patch->grains += feed.placed;
        patch->mass += feed.placed_mass;
        if (k == 1) patch->hard_mass = feed.placed_mass;
    }
    if (status == DEM_OK) {
        sieve_patch_set_step(patch);
        status = dem_run(&patch->world, 0.15, DEM_LINEAR | DEM_FRICTION);
    }
    if (status == DEM_OK) { /* from the top of its way, so that it is at rest again after every period */
        const double a = sieve_patch_amplitude(d);
        const dem_vec amplitude = dem_vec3(d->circular ? a : 0.0, 0.0, a), phase = dem_vec3(0.0, 0.0, 0.5 * RIDDLE_PI);
        status = dem_vibrate(&patch->world, patch->deck, amplitude, phase, d->frequency);
    }
    return status;
}

/* Lays an equal grain on top for each that passed, and takes its record, so that records don't pile up. One that finds
   no place waits. */
static inline dem_status sieve_patch_refill(sieve_patch *patch) {
    const sieve_patch_def *d = &patch->def;
    const double l = d->opening, side = d->across * (l + d->wire);
    double top = 0.5 * d->wire;
    for (ptrdiff_t i = 0; i < patch->world.count; i++)
        if (patch->world.alive[i]) top = fmax(top, dem_position(&patch->world, i).z);
    while (patch->world.passed_count > 0) {
        const dem_passed *p = patch->world.passed;
        dem_feed feed = dem_default_feed();
        feed.region =
            dem_box_region(dem_vec3(0.0, 0.0, fmin(top, 8.0 * l)), dem_vec3(side, side, fmin(top, 8.0 * l) + 4.0 * l));
        feed.sizes = dem_one_size(p->diameter);
        feed.group = p->group;
        feed.random = ++patch->random + d->seed * 1000003u;
        const dem_status status = dem_fill(&patch->world, &feed, 1);
        if (status != DEM_OK || feed.placed == 0) return status;
        patch->forced += p->diameter > d->opening;
        dem_take_passed(&patch->world, NULL, 1);
    }
    return DEM_OK;
}

/* Vibrates for a number of whole periods. */
static inline dem_status sieve_patch_vibrate(sieve_patch *patch, int periods) {
    dem_status status = DEM_OK;
    for (int k = 0; k < (patch->def.refill ? periods : 1) && status == DEM_OK; k++) {
        if (patch->def.refill) status = sieve_patch_refill(patch);
        sieve_patch_set_step(patch);
        if (status == DEM_OK)
            status = dem_run(&patch->world, (patch->def.refill ? 1 : periods) / patch->def.frequency,
                             DEM_LINEAR | DEM_FRICTION);
    }
    return status;
}

/* Holes through which grains do not fall out by themselves after the sieve is turned upside down (section 2.1), on a
   copy that is stopped, comes to rest, and is turned over: twice the weight, upwards. -1: it could not be run. */
static inline int sieve_patch_blocked(const sieve_patch *patch) {
    const size_t size = dem_save(&patch->world, NULL, 0);
    const dem_vec none = dem_vec3(0.0, 0.0, 0.0);
    void *bytes = malloc(size);
    dem_world w;
    if (!bytes) return -1;
    dem_save(&patch->world, bytes, size);
    memset(&w, 0, sizeof w);
    dem_status status = dem_load(&w, bytes, size, NULL);
    free(bytes);
    if (status == DEM_OK) status = dem_vibrate(&w, patch->deck, none, none, 0.0);
    if (status == DEM_OK) status = dem_run(&w, 0.05, DEM_LINEAR | DEM_FRICTION);
    for (ptrdiff_t i = 0; status == DEM_OK && i < w.count; i++)
        if (w.alive[i]) status = dem_set_load(&w, i, dem__scale(-2.0 * dem_mass(&w, i), w.def.gravity), none);
    if (status == DEM_OK) status = dem_run(&w, 0.1, DEM_LINEAR | DEM_FRICTION);
    const int blocked = status == DEM_OK ? dem_count_apertures(&w, patch->deck).occupied : -1;
    dem_free(&w);
    return blocked;
}

#endif
