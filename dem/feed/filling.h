/* Bodies of a source: drawn class by class, placed without overlap, added. Owns nothing; writes a world through its
   public functions. */
#pragma once
#include "places.h"

/* Moves a radius and its class down a heap, whose root is the smallest. */
static inline void dem__sift_size(double *heap, int32_t *line, ptrdiff_t root, ptrdiff_t n) {
    for (;;) {
        ptrdiff_t child = 2 * root + 1;
        if (child >= n) return;
        if (child + 1 < n && heap[child + 1] < heap[child]) child++;
        if (!(heap[child] < heap[root])) return;
        const double t = heap[root];
        const int32_t k = line[root];
        heap[root] = heap[child], heap[child] = t;
        line[root] = line[child], line[child] = k;
        root = child;
    }
}
/* Sorts radii and their classes, largest first. */
static inline void dem__sort_sizes(double *radius, int32_t *line, ptrdiff_t n) {
    for (ptrdiff_t k = n / 2 - 1; k >= 0; k--) dem__sift_size(radius, line, k, n);
    for (ptrdiff_t k = n - 1; k > 0; k--) {
        const double t = radius[0];
        const int32_t c = line[0];
        radius[0] = radius[k], radius[k] = t;
        line[0] = line[k], line[k] = c;
        dem__sift_size(radius, line, 0, k);
    }
}

/* A class of a source while bodies are drawn and placed. */
typedef struct dem__queue {
    dem_feed feed;
    double share, given;  /* share that the class has been given of what all have: [kg] or number */
    ptrdiff_t now, first; /* placed by this call; position of the first of them in the list */
} dem__queue;

/* Returns a number, not 0, that differs for different distributions: a diameter drawn ahead belongs to one of them. */
static inline uint64_t dem__mark_of(const dem_sizes *s, int polyhedron) {
    const double of[4] = {s->scale, s->spread, s->smallest, s->largest};
    uint64_t mark = (uint64_t)s->kind * 64u + (uint64_t)(s->by_mass != 0) * 32u + (uint64_t)polyhedron * 1024u;
    const int entries = s->kind == DEM_SIZES_LIST ? s->count : 0;
    for (int k = 0; k < 4 + 2 * entries; k++) {
        const double value = k < 4 ? of[k] : k % 2 ? s->share[(k - 4) / 2] : s->diameter[(k - 4) / 2];
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        mark += bits;
        mark = (mark ^ (mark >> 30)) * 0xbf58476d1ce4e5b9u;
        mark = (mark ^ (mark >> 27)) * 0x94d049bb133111ebu;
        mark ^= mark >> 31;
    }
    return mark | 1u;
}

/* Draws the next diameter of a class, unless one of its present sizes has been drawn already. */
static inline void dem__draw_ahead(dem_feed *feed, uint64_t *random) {
    const uint64_t mark = dem__mark_of(&feed->sizes, feed->polyhedron);
    if (feed->waiting > 0.0 && (feed->waiting_of == mark || feed->waiting_of == 0)) return;
    feed->waiting = dem_draw_size(&feed->sizes, random);
    feed->waiting_of = mark;
}

/* Returns the class whose turn it is: the one that comes closest to its share with its next body (Webster). */
static inline int dem__next_line(const dem_world *w, dem__queue *line, int classes, int by_number) {
    double earliest = HUGE_VAL;
    int next = 0;
    for (int k = 0; k < classes && classes > 1; k++) {
        if (!(line[k].share > 0.0)) continue;
        dem__draw_ahead(&line[k].feed, &line[0].feed.random);
        const double body = by_number ? 1.0 : dem__sphere_mass(w, line[k].feed.material, 0.5 * line[k].feed.waiting);
        const double turn = (line[k].given + 0.5 * body) / line[k].share;
        if (turn < earliest) earliest = turn, next = k;
    }
    return next;
}

/* Draws the bodies that are due one after the other, at most `most`. Returns how many, -1: stopped. radius, of: their
   radii and classes, or NULL. The first body that is not due is kept in its feed's `waiting`; dropping it would favour
   small ones. */
static inline ptrdiff_t dem__draw_due(const dem_world *w, dem__queue *line, const dem_source *source, double number,
                                      double mass, ptrdiff_t most, double *radius, int32_t *of) {
    for (ptrdiff_t n = 0; n < most; n++) {
        if (dem__is_stopped(w, n)) return -1;
        const int k = dem__next_line(w, line, source->classes, source->by_number);
        dem_feed *feed = &line[k].feed;
        dem__draw_ahead(feed, &line[0].feed.random);
        const double m = dem__sphere_mass(w, feed->material, 0.5 * feed->waiting);
        if (!((double)n + 0.5 <= number) || !(0.5 * m <= mass))
            return n; /* a source is late or early by half a particle at most */
        if (radius) radius[n] = 0.5 * feed->waiting, of[n] = k;
        mass -= m;
        line[k].given += source->by_number ? 1.0 : m;
        feed->waiting = 0.0;
    }
    return most;
}

/* New bodies of a source: as drawn and placed, then class by class in the order of memory. */
typedef struct dem__batch {
    double *radius, *piece, *place, *turn;              /* [n], [n][pieces], [n][3], [n][4] */
    double *diameter, *centre, *orientation, *velocity; /* [n], [n][3], [n][4], [n][3] */
    int32_t *of, *first;                                /* [n] class; the first of its pieces among those placed */
    ptrdiff_t pieces, bodies;                           /* of all bodies, as drawn; bodies of several pieces or of a
                                                           shape */
    size_t bytes;
} dem__batch;
static inline int dem__make_batch(dem__batch *b, const dem_allocator *memory, ptrdiff_t n, ptrdiff_t pieces) {
    b->bytes = (size_t)n * ((size_t)(19 + pieces) * sizeof(double) + 2 * sizeof(int32_t));
    b->radius = (double *)memory->fn(memory->user, NULL, 0, b->bytes);
    if (!b->radius) return 0;
    b->place = b->radius + n, b->turn = b->place + 3 * n, b->diameter = b->turn + 4 * n, b->centre = b->diameter + n;
    b->orientation = b->centre + 3 * n, b->velocity = b->orientation + 4 * n, b->piece = b->velocity + 3 * n;
    b->of = (int32_t *)(void *)(b->piece + pieces * n), b->first = b->of + n;
    return 1;
}

/* Returns how many bodies a call draws at most: a limit for a source that was blocked for long. */
static inline ptrdiff_t dem__most_drawn(int at_once) { return at_once ? INT32_MAX / 8 : 100000; }

/* Draws n radii, and computes those of their particles. Returns the largest radius of a body about its centre, or -1:
   stopped. */
static inline double dem__draw_batch(const dem_world *w, dem__batch *b, dem__queue *line, const dem_source *source,
                                     double number, double mass, ptrdiff_t n, int at_once) {
    double widest = 0.0;
    if (dem__draw_due(w, line, source, number, mass, dem__most_drawn(at_once), b->radius, b->of) < 0) return -1.0;
    if (at_once) dem__sort_sizes(b->radius, b->of, n);
    b->pieces = 0;
    for (ptrdiff_t k = 0; k < n; k++) {
        const dem_feed *feed = &line[b->of[k]].feed;
        const double r = b->radius[k], reach = r * dem__feed_reach(w, feed);
        for (ptrdiff_t q = 0; q < dem__feed_balls(feed); q++)
            b->piece[b->pieces++] = feed->clump ? r * dem__feed_scale(feed) * feed->clump->radius[q] : reach;
        widest = reach > widest ? reach : widest;
    }
    return widest;
}

/* Keeps what has been drawn and not placed, from body k on: the next of each class waits. */
static inline void dem__keep_waiting(dem__queue *line, const dem__batch *b, ptrdiff_t k, ptrdiff_t n) {
    for (ptrdiff_t q = n - 1; q >= k; q--) {
        dem_feed *feed = &line[b->of[q]].feed;
        feed->waiting = 2.0 * b->radius[q], feed->waiting_of = dem__mark_of(&feed->sizes, feed->polyhedron);
    }
}

/* Finds places for n bodies, and counts them as given by number or, with by_mass, by mass. at_once: bodies without a
   place count as missed; otherwise the first of them waits, and so do those after it. Returns how many have a place. */
static inline ptrdiff_t dem__find_places(dem_world *w, dem__room *room, dem__queue *line, dem_source *source,
                                         dem__batch *b, ptrdiff_t n, int by_mass, int at_once) {
    ptrdiff_t found = 0, pieces = 0;
    for (ptrdiff_t k = 0; k < n; k++) {
        dem_feed *feed = &line[b->of[k]].feed;
        const double radius = b->radius[k], m = dem__sphere_mass(w, feed->material, radius);
        dem_vec x;
        dem_quaternion q = dem__quaternion(1.0, dem_vec3(0.0, 0.0, 0.0));
        if (dem__find_place(w, room, &line[0].feed, feed, radius, &x, &q)) {
            double *turn = b->turn + 4 * found;
            dem__settle_body(w, room, feed, x, q, radius);
            for (int a = 0; a < 3; a++) b->place[3 * found + a] = dem_axis(x, a);
            turn[0] = q.w, turn[1] = q.x, turn[2] = q.y, turn[3] = q.z;
            b->first[found] = (int32_t)pieces, b->of[found] = b->of[k], b->radius[found++] = radius;
            pieces += dem__feed_balls(feed);
            feed->placed++, feed->placed_mass += m;
            line[b->of[k]].now++;
            if (by_mass) source->due_mass -= at_once ? 0.0 : m;
            else source->due -= at_once ? 0.0 : 1.0;
        } else if (room->stopped) return found;
        else if (at_once) {
            feed->missed++;
            feed->missed_mass += m;
        } else {
            dem__keep_waiting(line, b, k, n);
            return found;
        }
    }
    return found;
}

/* Returns the body to which a piece belongs. bodies: n. */
static inline ptrdiff_t dem__body_of_piece(const dem__batch *b, ptrdiff_t n, ptrdiff_t piece) {
    ptrdiff_t low = 0, high = n;
    while (high - low > 1) {
        const ptrdiff_t middle = low + (high - low) / 2;
        if (b->first[middle] <= piece) low = middle;
        else high = middle;
    }
    return low;
}

/* Lists the placed bodies class by class, in the order of the cells of their first particles, so that neighbours in
   space are neighbours in memory. n: their number. */
static inline void dem__list_placed(const dem__room *room, ptrdiff_t present, dem__queue *line, int classes,
                                    dem__batch *b, ptrdiff_t n) {
    for (int k = 1; k < classes; k++) line[k].first = line[k - 1].first + line[k - 1].now;
    for (int k = 0; k < classes; k++) line[k].now = 0;
    for (ptrdiff_t c = 0; c < room->cells; c++) {
        for (int32_t q = room->head[c]; q >= present; q = room->next[q]) {
            const ptrdiff_t body = dem__body_of_piece(b, n, q - present);
            if (b->first[body] != q - present) continue;
            dem__queue *of = &line[b->of[body]];
            const ptrdiff_t to = of->first + of->now++;
            b->diameter[to] = 2.0 * b->radius[body];
            for (int a = 0; a < 4; a++) b->orientation[4 * to + a] = b->turn[4 * body + a];
            for (int a = 0; a < 3; a++) {
                b->centre[3 * to + a] = b->place[3 * body + a];
                b->velocity[3 * to + a] =
                    dem_axis(of->feed.velocity, a) +
                    dem_axis(of->feed.scatter, a) * (2.0 * dem__uniform(&line[0].feed.random) - 1.0);
            }
        }
    }
}

/* Adds the new bodies of a class with their velocities, or none. */
static inline dem_status dem__add_moving(dem_world *w, const dem__queue *line, const dem__batch *b) {
    const dem_feed *feed = &line->feed;
    const ptrdiff_t pieces = dem__feed_pieces(feed), n = line->now, first = line->first;
    const double *centre = b->centre + 3 * first, *turn = b->orientation + 4 * first, *d = b->diameter + first;
    dem_status status;
    if (feed->polyhedron)
        status = w->engine->convex.calls->add(w, feed->polyhedron - 1, n, centre, turn, feed->material, feed->group);
    else if (feed->compound)
        status = feed->compound->add__(w, n, feed->compound, centre, turn, feed->material, feed->group);
    else if (feed->clump) status = feed->clump->add__(w, n, feed->clump, centre, d, turn, feed->material, feed->group);
    else status = dem_add_spheres(w, n, centre, d, feed->material, feed->group);
    for (ptrdiff_t k = 0; k < n && status == DEM_OK; k++) {
        const double *v = b->velocity + 3 * (first + k);
        dem_set_motion(w, w->count - (n - k) * pieces, dem_vec3(v[0], v[1], v[2]), dem_vec3(0.0, 0.0, 0.0));
    }
    return status;
}

/* Adds all new bodies, or none: with several classes, makes room for all before the first. */
static inline dem_status dem__add_lines(dem_world *w, const dem__queue *line, int classes, const dem__batch *b) {
    ptrdiff_t pieces = 0, bodies = 0;
    dem_status status = DEM_OK;
    for (int k = 0; k < classes; k++) {
        pieces += line[k].now * dem__feed_pieces(&line[k].feed);
        if (line[k].feed.clump || line[k].feed.polyhedron || line[k].feed.compound) bodies += line[k].now;
    }
    if (classes > 1 && pieces > INT32_MAX / 4 - w->count) return DEM_TOO_MANY;
    if (classes > 1 && !(bodies ? dem__reserve_bodies(w, bodies, pieces) : dem__reserve_particles(w, pieces)))
        return DEM_OUT_OF_MEMORY;
    for (int k = 0; k < classes && status == DEM_OK; k++) {
        if (line[k].now > 0 || classes == 1) status = dem__add_moving(w, &line[k], b);
    }
    return status;
}

/* Draws n bodies, finds places for them, and lists those that have one. */
static inline dem_status dem__place_batch(dem_world *w, dem__queue *line, dem_source *source, dem__batch *b,
                                          double number, double mass, ptrdiff_t n, int at_once) {
    dem__room room;
    const double widest = dem__draw_batch(w, b, line, source, number, mass, n, at_once);
    if (widest < 0.0) return DEM_STOPPED;
    dem_status status = dem__make_room(&room, w, &line[0].feed.region, b->piece, b->pieces, widest);
    if (status == DEM_OK) {
        const ptrdiff_t present = room.count;
        const ptrdiff_t placed = dem__find_places(w, &room, line, source, b, n, mass < HUGE_VAL, at_once);
        dem__list_placed(&room, present, line, source->classes, b, placed);
        if (room.stopped) status = DEM_STOPPED;
    }
    dem__clear_room(&room, w);
    return status;
}
