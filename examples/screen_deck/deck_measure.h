/* deck_measure.h - what is measured on a deck_scene.h machine: which grain left where, when the machine is steady, and
   then the partition curve, the flow along the deck, blocked holes and times of residence, with intervals from batch
   means over windows. */
#ifndef DECK_MEASURE_H
#define DECK_MEASURE_H

#include "deck_scene.h"

enum { DECK_CLASSES = 16, DECK_ZONES = 12, DECK_BATCHES = 10, DECK_STEADY_WINDOWS = 8, DECK_STATIONS = 24 };
static const double DECK_HELD = 0.5; /* a grain that stays so long in one hole blocks it [s] */

/* ---- statistics: pure functions ---- */

/* Two-sided 95 % quantile of Student's t: from a table, from 5 degrees of freedom on to 0.15 % (Cornish-Fisher
   expansion about 1.96). */
static inline double deck_student(int freedom) {
    static const double few[] = {HUGE_VAL, 12.706, 4.303, 3.182, 2.776};
    const double z = 1.959963984540054, v = freedom, a = (z * z * z + z) / 4.0,
                 b = (5.0 * pow(z, 5) + 16.0 * z * z * z + 3.0 * z) / 96.0,
                 c = (3.0 * pow(z, 7) + 19.0 * pow(z, 5) + 17.0 * z * z * z - 15.0 * z) / 384.0;
    return freedom < 5 ? few[freedom < 0 ? 0 : freedom] : z + a / v + b / (v * v) + c / (v * v * v);
}

typedef struct deck_estimate {
    double value, interval; /* 95 %; NaN if not to be told */
} deck_estimate;

/* Mean of n values and its interval. */
static inline deck_estimate deck_mean(int n, const double *x) {
    deck_estimate e = {(double)NAN, (double)NAN};
    double mean = 0.0, square = 0.0;
    if (n < 1) return e;
    for (int k = 0; k < n; k++) mean += x[k] / n;
    for (int k = 0; k < n; k++) square += (x[k] - mean) * (x[k] - mean);
    e.value = mean;
    if (n > 1) e.interval = deck_student(n - 1) * sqrt(square / (n - 1) / n);
    return e;
}

/* Ratio of two sums over n batches, and its interval by the batches' residuals (ratio estimator, Cochran 1977, section
   6.4). NaN where the lower sum is not positive. */
static inline deck_estimate deck_ratio(int n, const double *upper, const double *lower) {
    deck_estimate e = {(double)NAN, (double)NAN};
    double a = 0.0, b = 0.0, square = 0.0;
    for (int k = 0; k < n; k++) a += upper[k], b += lower[k];
    if (!(b > 0.0)) return e;
    e.value = a / b;
    for (int k = 0; k < n; k++) square += (upper[k] - e.value * lower[k]) * (upper[k] - e.value * lower[k]);
    if (n > 1) e.interval = deck_student(n - 1) * sqrt(n * square / (n - 1)) / b;
    return e;
}

/* Whether n windows, 4 or more, are steady: what comes in and what leaves [kg each] differ by no more than their own
   scatter, and by less than `tolerance` of the feed for certain; no more leaves in the second half than in the first,
   beyond that scatter; and the mean hold-up [kg each] of the two halves differs by less than half the
   tolerance. 1 or 0. */
static inline int deck_is_steady(int n, const double *in, const double *out, const double *holdup, double tolerance) {
    double gain[64], feed = 0.0, leaves[2] = {0.0, 0.0}, holds[2] = {0.0, 0.0}, square = 0.0;
    const int half[2] = {n / 2, n - n / 2};
    if (n < 4 || n > 64) return 0;
    for (int k = 0; k < n; k++) {
        const int late = k >= half[0];
        gain[k] = in[k] - out[k];
        feed += in[k] / n;
        leaves[late] += out[k] / half[late], holds[late] += holdup[k] / half[late];
    }
    const deck_estimate rest = deck_mean(n, gain);
    for (int k = 0; k < n; k++) square += pow(out[k] - leaves[k >= half[0]], 2.0) / (n - 2);
    const double drift = deck_student(n - 2) * sqrt(square * (1.0 / half[0] + 1.0 / half[1]));
    if (!(feed > 0.0 && holds[0] + holds[1] < HUGE_VAL)) return 0;
    return fabs(rest.value) <= rest.interval && fabs(rest.value) + rest.interval <= tolerance * feed &&
           fabs(leaves[1] - leaves[0]) <= drift &&
           fabs(holds[1] - holds[0]) <= 0.25 * tolerance * (holds[0] + holds[1]);
}

/* ---- books ---- */

/* Size classes: edges in shares of the first deck's aperture, which is one of them. */
typedef struct deck_classes {
    int count;
    double edge[DECK_CLASSES + 1];
} deck_classes;

static inline deck_classes deck_cut_classes(const deck_def *d) {
    static const double share[] = {0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0, 3.0};
    const double small = deck_smallest(&d->sizes), most = deck_largest(&d->sizes) * (1.0 + 1e-9);
    deck_classes c = {0, {small}};
    for (size_t k = 0; k < sizeof share / sizeof *share; k++) {
        double edge = share[k] * d->aperture[0];
        for (int q = 1; q < d->decks; q++) /* the nearest edge becomes a lower deck's aperture */
            if (d->aperture[q] > edge * 0.92 && d->aperture[q] < edge * 1.1 && share[k] != 1.0) edge = d->aperture[q];
        if (edge > c.edge[c.count] * 1.02 && edge < most / 1.02) c.edge[++c.count] = edge;
    }
    c.edge[++c.count] = most;
    return c;
}
static inline int deck_class_of(const deck_classes *c, double diameter) {
    int k = 0;
    while (k < c->count - 1 && diameter >= c->edge[k + 1]) k++;
    return k;
}

typedef struct deck_grain {
    double fed, diameter, mass;
    double since, hole_x, hole_y; /* in which hole it has stood since when, in the deck's frame; since < 0: in none */
    int klass, level;             /* deck below it, from 0 on; decks: it is below the last */
    bool left;
} deck_grain;

/* Something that happened to a grain: it passed the mesh of deck `level`, or left over its end (level = decks:
   as underflow). */
typedef struct deck_event {
    double time, x, mass, stay; /* [s], place along the deck [m], [kg], time since it was fed [s] */
    int klass, level;
    bool left;
} deck_event;

/* Sums over the looks of a window, by deck and zone of its length. */
typedef struct deck_zone {
    double mass, momentum, height; /* sum of m, m v_x, m z over the wires */
    double held, sitting;          /* holes with a grain that blocks, or sits in them; of slots, blocked
                                      length over pitch */
} deck_zone;
typedef struct deck_window {
    double fed, left, holdup; /* [kg]; mean of grains present [kg] */
    double grains;            /* mean number */
    int looks;
    deck_zone zone[DECKS_MAX][DECK_ZONES];
} deck_window;

typedef struct deck_books {
    deck_classes classes;
    ptrdiff_t grains, grain_room, events, event_room, windows, window_room;
    deck_grain *grain; /* by id */
    deck_event *event;
    deck_window *window;
    double window_time;          /* [s] */
    ptrdiff_t fed[DECK_CLASSES]; /* numbers by class, from the start */
    ptrdiff_t left[DECKS_MAX + 1][DECK_CLASSES];
    double first_over, first_left; /* when the first grain left over the first deck's end, or anywhere [s];
                                      infinite: none yet */
    int steady, finish;            /* windows: first steady one or -1; where measuring ends */
} deck_books;

/* Room for one more, doubling. 0, or -1 out of memory. */
static inline int deck_room(void **block, ptrdiff_t count, ptrdiff_t *room, size_t size) {
    if (count < *room) return 0;
    const ptrdiff_t wanted = *room ? 2 * *room : 1024;
    void *bigger = realloc(*block, (size_t)wanted * size);
    if (!bigger) return -1;
    *block = bigger, *room = wanted;
    return 0;
}

static inline void deck_books_free(deck_books *b) {
    free(b->grain), free(b->event), free(b->window);
    memset(b, 0, sizeof *b);
}

static inline void deck_books_open(deck_books *b, const deck_def *d, double window) {
    memset(b, 0, sizeof *b);
    b->classes = deck_cut_classes(d);
    b->window_time = window;
    b->first_over = b->first_left = HUGE_VAL;
    b->steady = b->finish = -1;
}

static inline int deck_note(deck_books *b, uint64_t id, double time, double x, int level, bool left) {
    const deck_grain *g = &b->grain[id];
    void *block = b->event;
    if (deck_room(&block, b->events, &b->event_room, sizeof *b->event)) return -1;
    b->event = block;
    const deck_event e = {time, x, g->mass, time - g->fed, g->klass, level, left};
    b->event[b->events++] = e;
    return 0;
}

/* Grains that have been fed since the last look. */
static inline int deck_book_fed(deck_books *b, const deck_machine *k, deck_window *w) {
    for (ptrdiff_t i = 0; i < k->world.count; i++) {
        const uint64_t id = k->world.id[i];
        if (id < (uint64_t)b->grains) continue;
        while ((uint64_t)b->grains <= id) {
            void *block = b->grain;
            if (deck_room(&block, b->grains, &b->grain_room, sizeof *b->grain)) return -1;
            b->grain = block;
            memset(&b->grain[b->grains], 0, sizeof *b->grain);
            b->grain[b->grains++].klass = -1;
        }
        deck_grain *g = &b->grain[id];
        g->diameter = 2.0 * dem_radius(&k->world, i), g->mass = dem_mass(&k->world, i);
        g->fed = k->world.time - k->step, g->since = -1.0;
        g->klass = deck_class_of(&b->classes, g->diameter);
        b->fed[g->klass]++;
        w->fed += g->mass;
    }
    return 0;
}

/* A grain is below a deck when all of it is. Those that it has passed since the last look are noted where it is now. */
static inline int deck_book_level(deck_books *b, const deck_def *d, uint64_t id, double time, double x, double top) {
    deck_grain *g = &b->grain[id];
    while (g->level < d->decks && top < deck_height(d, g->level))
        if (deck_note(b, id, time, x, g->level++, false)) return -1;
    return 0;
}

/* Grains that left: over the end of the deck that their centre is above, or as underflow. */
static inline int deck_book_left(deck_books *b, deck_machine *k, deck_window *w) {
    for (ptrdiff_t q = 0; q < k->world.passed_count; q++) {
        const dem_passed *p = &k->world.passed[q];
        if (p->id >= (uint64_t)b->grains) return -1;
        deck_grain *g = &b->grain[p->id];
        if (deck_book_level(b, &k->def, p->id, p->time, fmin(p->position.x, k->def.length), p->position.z)) return -1;
        if (deck_note(b, p->id, p->time, fmin(p->position.x, k->def.length), g->level, true)) return -1;
        b->left[g->level][g->klass]++;
        g->left = true;
        w->left += g->mass;
        b->first_left = fmin(b->first_left, p->time);
        if (g->level == 0) b->first_over = fmin(b->first_over, p->time);
    }
    dem_take_passed(&k->world, NULL, k->world.passed_count);
    return 0;
}

/* A grain stands in a hole while its centre is within one radius of the wires' plane and within a tenth of the aperture
   of the place where it came to stand, in the frame of the deck. */
static inline void deck_book_hole(deck_grain *g, const deck_machine *k, dem_vec at, double radius, deck_zone *zone) {
    const dem_wall *wall = &k->world.wall[g->level];
    const double x = at.x - (wall->position.x - wall->asked.origin.x), y = at.y, z = at.z - wall->position.z;
    const double aperture = k->def.aperture[g->level];
    const bool in = z < radius - 0.05 * aperture && z > -radius; /* on the flat top of a bar z is the radius */
    if (!in || g->since < 0.0 || hypot(x - g->hole_x, y - g->hole_y) > 0.1 * aperture) {
        g->since = in ? k->world.time : -1.0;
        g->hole_x = x, g->hole_y = y;
    }
    if (!in) return;
    const double share = k->def.mesh == DECK_SQUARE ? 1.0 : 2.0 * radius / deck_pitch(&k->def, g->level);
    zone->sitting += share;
    if (k->world.time - g->since >= DECK_HELD) zone->held += share;
}

/* One look, after a step of deck_advance. 0, or -1 out of memory. */
static inline int deck_look(deck_books *b, deck_machine *k) {
    const deck_def *d = &k->def;
    const ptrdiff_t number = (ptrdiff_t)((k->world.time - 0.5 * k->step) / b->window_time);
    while (b->windows <= number) {
        void *block = b->window;
        if (deck_room(&block, b->windows, &b->window_room, sizeof *b->window)) return -1;
        b->window = block;
        memset(&b->window[b->windows++], 0, sizeof *b->window);
    }
    deck_window *w = &b->window[number];
    if (deck_book_fed(b, k, w) || deck_book_left(b, k, w)) return -1;
    w->looks++;
    for (ptrdiff_t i = 0; i < k->world.count; i++) {
        if (!k->world.alive[i]) continue;
        const dem_vec at = dem_position(&k->world, i);
        const uint64_t id = k->world.id[i];
        const double radius = dem_radius(&k->world, i);
        if (deck_book_level(b, d, id, k->world.time, at.x, at.z + radius)) return -1;
        deck_grain *g = &b->grain[id];
        w->holdup += g->mass, w->grains += 1.0;
        /* What falls onto the deck is not yet on it. */
        if (g->level >= d->decks || at.z > k->feed.region.low.z) continue;
        deck_zone *zone = &w->zone[g->level][(int)fmin(fmax(at.x / d->length * DECK_ZONES, 0.0), DECK_ZONES - 1.0)];
        zone->mass += g->mass;
        zone->momentum += g->mass * dem_velocity(&k->world, i).x;
        zone->height += g->mass * (at.z - deck_height(d, g->level));
        deck_book_hole(g, k, at, radius, zone);
    }
    return 0;
}

/* Windows that are over. */
static inline int deck_windows_done(const deck_books *b, const deck_machine *k) {
    return (int)fmin((double)b->windows, floor((k->world.time + 0.5 * k->step) / b->window_time));
}

/* At the end of a window: looks for the steady state, from when grains have crossed the deck twice over. As many
   windows as a small section needs for its scatter to allow a judgement are taken together: 1, 2, 4 ... */
static inline void deck_find_steady(deck_books *b, int windows, double tolerance, double measure) {
    double in[DECK_STEADY_WINDOWS], out[DECK_STEADY_WINDOWS], holdup[DECK_STEADY_WINDOWS];
    const int need = DECK_STEADY_WINDOWS;
    const double crossed = b->first_over < HUGE_VAL ? b->first_over : b->first_left; /* everything may pass the mesh */
    for (int together = 1; b->steady < 0 && need * together <= windows; together *= 2) {
        const int first = windows - need * together;
        if (!(first * b->window_time >= 2.0 * crossed)) return;
        for (int q = 0; q < need; q++) {
            in[q] = out[q] = holdup[q] = 0.0;
            for (int w = 0; w < together; w++) {
                const deck_window *window = &b->window[first + q * together + w];
                in[q] += window->fed, out[q] += window->left;
                holdup[q] += window->holdup / window->looks / together;
            }
        }
        if (!deck_is_steady(need, in, out, holdup, tolerance)) continue;
        b->steady = first;
        b->finish = first + (int)fmax(need * together, ceil(measure / b->window_time - 1e-9));
    }
}

/* ---- answers ---- */

/* Of a deck, over the steady windows. Curves by class: what arrives is what passes the mesh and what leaves
   over the end. */
typedef struct deck_answer {
    double duration;                                    /* [s] */
    deck_estimate partition[DECK_CLASSES];              /* share of a class that leaves over the end */
    double arrived[DECK_CLASSES], grains[DECK_CLASSES]; /* [kg]; numbers */
    double size[DECK_CLASSES];                          /* mean diameter by mass of what arrived [m] */
    double retained[DECK_CLASSES][DECK_STATIONS];       /* share still on the deck at (s + 1)/STATIONS of its length */
    deck_estimate recovery;                             /* share of what is smaller than the aperture that passes */
    deck_estimate over, under;                          /* flows [kg/s] */
    deck_estimate undersize_in_over, oversize_in_under; /* mass shares of the products */
    double largest_under;                               /* grain that passed [m]: soft ones are a little wider
                                                           than the holes */
    double load[DECK_ZONES], depth[DECK_ZONES], velocity[DECK_ZONES]; /* [kg/m2], [m], [m/s] */
    deck_estimate held[DECK_ZONES], sitting[DECK_ZONES];              /* shares of the holes */
    double stay, stay_low, stay_high;                                 /* of what leaves over the end [s] */
} deck_answer;

static inline int deck_compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Mean time from feed to the end of the deck, and 10 and 90 %. */
static inline void deck_stays(const deck_books *b, int level, double from, double to, deck_answer *a) {
    double *stay = malloc((size_t)(b->events + 1) * sizeof *stay), sum = 0.0;
    int n = 0;
    a->stay = a->stay_low = a->stay_high = (double)NAN;
    for (ptrdiff_t e = 0; e < b->events && stay; e++) {
        const deck_event *v = &b->event[e];
        if (v->left && v->level == level && v->time >= from && v->time < to) sum += stay[n++] = v->stay;
    }
    if (n > 0) {
        qsort(stay, (size_t)n, sizeof *stay, deck_compare);
        a->stay = sum / n, a->stay_low = stay[n / 10], a->stay_high = stay[(int)(0.9 * n)];
    }
    free(stay);
}

/* Sums of what arrived and what left over, by class and batch. */
typedef struct deck_sums {
    double arrived[DECK_CLASSES][DECK_BATCHES], over[DECK_CLASSES][DECK_BATCHES];
    double under_all[DECK_BATCHES], over_all[DECK_BATCHES], fine[DECK_BATCHES], fine_passed[DECK_BATCHES],
        fine_over[DECK_BATCHES], coarse_passed[DECK_BATCHES];
} deck_sums;

static inline void deck_sum_events(const deck_books *b, const deck_def *d, int level, double from, double to,
                                   deck_sums *s, deck_answer *a) {
    double place[DECK_CLASSES][DECK_STATIONS + 1];
    memset(s, 0, sizeof *s);
    memset(place, 0, sizeof place);
    for (ptrdiff_t e = 0; e < b->events; e++) {
        const deck_event *v = &b->event[e];
        if (v->level != level || v->time < from || v->time >= to) continue;
        const int batch = (int)fmin((v->time - from) / (to - from) * DECK_BATCHES, DECK_BATCHES - 1.0);
        const double size = cbrt(v->mass / (d->density * RIDDLE_PI / 6.0));
        s->arrived[v->klass][batch] += v->mass;
        a->arrived[v->klass] += v->mass, a->size[v->klass] += v->mass * size, a->grains[v->klass] += 1.0;
        (v->left ? s->over_all : s->under_all)[batch] += v->mass;
        if (v->left) s->over[v->klass][batch] += v->mass;
        else place[v->klass][(int)fmin(fmax(v->x / d->length * DECK_STATIONS, 0.0), DECK_STATIONS - 1.0)] += v->mass;
        if (size < d->aperture[level]) {
            s->fine[batch] += v->mass;
            (v->left ? s->fine_over : s->fine_passed)[batch] += v->mass;
        } else if (!v->left) s->coarse_passed[batch] += v->mass;
        if (!v->left) a->largest_under = fmax(a->largest_under, size);
    }
    for (int c = 0; c < b->classes.count; c++) {
        double here = 0.0;
        for (int q = 0; q < DECK_STATIONS; q++) {
            here += place[c][q];
            a->retained[c][q] = a->arrived[c] > 0.0 ? 1.0 - here / a->arrived[c] : (double)NAN;
        }
        a->size[c] =
            a->arrived[c] > 0.0 ? a->size[c] / a->arrived[c] : sqrt(b->classes.edge[c] * b->classes.edge[c + 1]);
    }
}

/* Zones: means over looks; intervals of blocked holes by batches of windows. */
static inline void deck_sum_zones(const deck_books *b, const deck_def *d, int level, int first, int end,
                                  deck_answer *a) {
    const double area = d->length * d->width / DECK_ZONES, pitch = deck_pitch(d, level);
    const double holes = area / (pitch * pitch); /* of slots: lengths of a pitch */
    for (int z = 0; z < DECK_ZONES; z++) {
        deck_zone sum = {0.0, 0.0, 0.0, 0.0, 0.0};
        double looks[DECK_BATCHES] = {0.0}, held[DECK_BATCHES] = {0.0}, sitting[DECK_BATCHES] = {0.0}, all = 0.0;
        for (int w = first; w < end; w++) {
            const deck_zone *q = &b->window[w].zone[level][z];
            const int batch = (w - first) * DECK_BATCHES / (end - first);
            sum.mass += q->mass, sum.momentum += q->momentum, sum.height += q->height;
            looks[batch] += b->window[w].looks * holes, held[batch] += q->held, sitting[batch] += q->sitting;
            all += b->window[w].looks;
        }
        a->load[z] = sum.mass / (all * area);
        a->velocity[z] = sum.momentum / sum.mass;
        a->depth[z] = fmax(2.0 * (sum.height / sum.mass - 0.5 * d->wire[level]), 0.0);
        a->held[z] = deck_ratio(DECK_BATCHES, held, looks);
        a->sitting[z] = deck_ratio(DECK_BATCHES, sitting, looks);
    }
}

/* What deck `level` did in windows first .. end - 1. */
static inline void deck_measure(const deck_books *b, const deck_def *d, int level, int first, int end, deck_answer *a) {
    const double from = first * b->window_time, to = end * b->window_time;
    double share[DECK_BATCHES], under[DECK_BATCHES];
    deck_sums s;
    memset(a, 0, sizeof *a);
    a->duration = to - from;
    deck_sum_events(b, d, level, from, to, &s, a);
    for (int c = 0; c < b->classes.count; c++) {
        deck_estimate *p = &a->partition[c];
        *p = deck_ratio(DECK_BATCHES, s.over[c], s.arrived[c]);
        /* none of n went the other way: up to 3/n may (rule of three); what is larger than the holes cannot */
        if ((p->value == 0.0 || p->value == 1.0) && b->classes.edge[c] < d->aperture[level])
            p->interval = 3.0 / a->grains[c];
    }
    a->recovery = deck_ratio(DECK_BATCHES, s.fine_passed, s.fine);
    a->undersize_in_over = deck_ratio(DECK_BATCHES, s.fine_over, s.over_all);
    a->oversize_in_under = deck_ratio(DECK_BATCHES, s.coarse_passed, s.under_all);
    for (int q = 0; q < DECK_BATCHES; q++) {
        share[q] = s.over_all[q] * DECK_BATCHES / a->duration;
        under[q] = s.under_all[q] * DECK_BATCHES / a->duration;
    }
    a->over = deck_mean(DECK_BATCHES, share), a->under = deck_mean(DECK_BATCHES, under);
    deck_sum_zones(b, d, level, first, end, a);
    deck_stays(b, level, from, to, a);
}

#endif
