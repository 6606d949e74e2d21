/* Placing particles without overlap, at once or over time. Owns nothing; writes a world through its public functions.
 */
#pragma once
#include "room.h"

/* Draws a place at which a sphere lies within a region; along directions in which the region is flat, its centre does.
   Returns 0 if the region is too small. */
static inline int dem__random_place(const dem_region *r, double radius, uint64_t *random, dem_vec *x) {
    if (r->kind == DEM_REGION_BOX || r->kind == DEM_REGION_MESH) { /* of a mesh: in the box around it */
        for (int a = 0; a < 3; a++) {
            const double low = dem_axis(r->low, a), room = dem_axis(r->high, a) - low - 2.0 * radius;
            if (room + 2.0 * radius > 0.0 && !(room >= 0.0)) return 0;
            *dem_axis_of(x, a) = room >= 0.0 ? low + radius + room * dem__uniform(random) : low;
        }
        return 1;
    }
    const int cylinder = r->kind == DEM_REGION_CYLINDER;
    const double room = r->radius - radius, length = r->length - 2.0 * radius;
    double u[3], square;
    if (!(room >= 0.0) || (cylinder && r->length > 0.0 && !(length >= 0.0))) return 0;
    int tries = 0;
    do {
        square = 0.0;
        for (int a = 0; a < 3 - cylinder; a++) {
            u[a] = 2.0 * dem__uniform(random) - 1.0;
            square += u[a] * u[a];
        }
    } while (square > 1.0 && ++tries < 1000);
    if (!cylinder) {
        *x = dem__add(r->low, dem__scale(room, dem_vec3(u[0], u[1], u[2])));
        return 1;
    }
    dem_wall frame;
    if (!dem__frame(&frame, r->axis, dem_vec3(1.0, 0.0, 0.0))) return 0;
    u[2] = r->length > 0.0 ? radius + length * dem__uniform(random) : 0.0;
    *x = dem__add(dem__add(r->low, dem__scale(room * u[0], frame.axis[0])),
                  dem__add(dem__scale(room * u[1], frame.axis[1]), dem__scale(u[2], frame.axis[2])));
    return 1;
}

/* Moves a radius down a heap, whose root is the smallest. */
static inline void dem__sift_size(double *heap, ptrdiff_t root, ptrdiff_t n) {
    for (;;) {
        ptrdiff_t child = 2 * root + 1;
        if (child >= n) return;
        if (child + 1 < n && heap[child + 1] < heap[child]) child++;
        if (!(heap[child] < heap[root])) return;
        const double t = heap[root];
        heap[root] = heap[child], heap[child] = t;
        root = child;
    }
}
/* Sorts radii, largest first. */
static inline void dem__sort_sizes(double *radius, ptrdiff_t n) {
    for (ptrdiff_t k = n / 2 - 1; k >= 0; k--) dem__sift_size(radius, k, n);
    for (ptrdiff_t k = n - 1; k > 0; k--) {
        const double t = radius[0];
        radius[0] = radius[k], radius[k] = t;
        dem__sift_size(radius, 0, k);
    }
}

/* Draws the particles that are due one after the other, at most `most`. Returns their number; radius: their radii, or
   NULL. The first that is not due is kept in feed->waiting: to leave it out would favour small ones. -1: stopped. */
static inline ptrdiff_t dem__draw_due(const dem_world *w, dem_feed *feed, double number, double mass, ptrdiff_t most,
                                      double *radius) {
    for (ptrdiff_t n = 0; n < most; n++) {
        if (dem__is_stopped(w, n)) return -1;
        if (!(feed->waiting > 0.0)) feed->waiting = dem_draw_size(&feed->sizes, &feed->random);
        const double m = dem__sphere_mass(w, feed->material, 0.5 * feed->waiting);
        if (!((double)n + 0.5 <= number) || !(0.5 * m <= mass))
            return n; /* a source is late or early by half a particle at most */
        if (radius) radius[n] = 0.5 * feed->waiting;
        mass -= m;
        feed->waiting = 0.0;
    }
    return most;
}

/* Draws an orientation, all equally likely: a point of the unit ball in four dimensions, scaled to length 1. */
static inline dem_quaternion dem__random_turn(uint64_t *random) {
    dem_quaternion q = dem__quaternion(1.0, dem_vec3(0.0, 0.0, 0.0));
    for (int tries = 0; tries < 1000; tries++) {
        double u[4], square = 0.0;
        for (int a = 0; a < 4; a++) u[a] = 2.0 * dem__uniform(random) - 1.0, square += u[a] * u[a];
        if (square <= 1.0 && square > 1e-6 && dem__unit_turn(dem__quaternion(u[0], dem_vec3(u[1], u[2], u[3])), &q))
            break;
    }
    return q;
}

/* Returns the number of particles in a body of a feed. */
static inline ptrdiff_t dem__feed_pieces(const dem_feed *feed) { return feed->clump ? feed->clump->spheres : 1; }
/* Returns the polyhedron of a feed, or NULL. */
static inline const dem_convex *dem__feed_shape(const dem_world *w, const dem_feed *feed) {
    return feed->polyhedron > 0 ? &w->engine->convex.shape[feed->polyhedron - 1] : NULL;
}
/* Returns the diameter of the sphere with a polyhedron's volume. */
static inline double dem__convex_diameter(const dem_convex *s) {
    return 2.0 * riddle_cbrt(s->volume / (4.0 / 3.0 * RIDDLE_PI));
}
/* Returns the factor of a clump's lengths for a body whose volume is that of a sphere of radius 1. */
static inline double dem__feed_scale(const dem_feed *feed) {
    return feed->clump ? 2.0 / dem_clump_diameter(feed->clump) : 1.0;
}
/* Returns the radius of such a body about its centre. */
static inline double dem__feed_reach(const dem_world *w, const dem_feed *feed) {
    const dem_convex *s = dem__feed_shape(w, feed);
    if (s) return 2.0 * s->reach / dem__convex_diameter(s);
    return feed->clump ? dem__feed_scale(feed) * dem__clump_reach(feed->clump) : 1.0;
}

/* Returns where particle k of a clump is in a body with the volume of a sphere of the given radius; piece: the
   particle's radius. */
static inline dem_vec dem__piece_place(const dem_world *w, const dem_feed *feed, dem_vec x, dem_quaternion turn,
                                       double radius, int k, double *piece) {
    const double scale = radius * dem__feed_scale(feed);
    *piece = scale * feed->clump->radius[k];
    return dem__in_box(w, dem__plus(x, scale, dem__to_lab(turn, feed->clump->centre[k])));
}

/* Returns whether a body of a feed is free at x. */
static inline int dem__has_room(const dem_world *w, const dem__room *room, const dem_feed *feed, dem_vec x,
                                dem_quaternion turn, double radius) {
    if (!feed->clump) return dem__is_free(w, room, x, radius * dem__feed_reach(w, feed), feed->group);
    for (int k = 0; k < feed->clump->spheres; k++) {
        double piece;
        const dem_vec at = dem__piece_place(w, feed, x, turn, radius, k, &piece);
        if (!dem__is_free(w, room, at, piece, feed->group)) return 0;
    }
    return 1;
}

/* Finds a free place for a body of a feed, by random tries. Returns 0 if there was none. */
static inline int dem__find_place(dem_world *w, dem__room *room, dem_feed *feed, double radius, dem_vec *x,
                                  dem_quaternion *turn) {
    const double reach = radius * dem__feed_reach(w, feed);
    for (int tries = 0; tries < feed->tries; tries++) {
        if (dem__is_stopped(w, room->looked++)) {
            room->stopped = 1;
            return 0;
        }
        if (!dem__random_place(&feed->region, reach, &feed->random, x)) return 0;
        *x = dem__in_box(w, *x); /* as dem_add_spheres does */
        if (feed->clump || feed->polyhedron) *turn = dem__random_turn(&feed->random);
        if (dem__has_room(w, room, feed, *x, *turn, radius)) return 1;
    }
    return 0;
}

/* Adds the particles of a body to the lists, in their order. */
static inline void dem__settle_body(const dem_world *w, dem__room *room, const dem_feed *feed, dem_vec x,
                                    dem_quaternion turn, double radius) {
    if (!feed->clump) dem__settle_in(room, x, radius * dem__feed_reach(w, feed));
    for (int k = 0; feed->clump && k < feed->clump->spheres; k++) {
        double piece;
        const dem_vec at = dem__piece_place(w, feed, x, turn, radius, k, &piece);
        dem__settle_in(room, at, piece);
    }
}

/* New bodies of a feed: as drawn and placed, then in the order of memory. */
typedef struct dem__batch {
    double *radius, *piece, *place, *turn;              /* [n], [n][pieces], [n][3], [n][4] */
    double *diameter, *centre, *orientation, *velocity; /* [n], [n][3], [n][4], [n][3] */
    size_t bytes;
} dem__batch;
static inline int dem__make_batch(dem__batch *b, const dem_allocator *memory, ptrdiff_t n, ptrdiff_t pieces) {
    b->bytes = (size_t)n * (size_t)(19 + pieces) * sizeof(double);
    b->radius = (double *)memory->fn(memory->user, NULL, 0, b->bytes);
    if (!b->radius) return 0;
    b->place = b->radius + n, b->turn = b->place + 3 * n, b->diameter = b->turn + 4 * n, b->centre = b->diameter + n;
    b->orientation = b->centre + 3 * n, b->velocity = b->orientation + 4 * n, b->piece = b->velocity + 3 * n;
    return 1;
}

/* Returns how many bodies a call draws at most; a limit for a source that was blocked for long. */
static inline ptrdiff_t dem__most_drawn(int at_once) { return at_once ? INT32_MAX / 8 : 100000; }

/* Draws n radii, and computes those of their particles. Returns the largest radius of a body, or -1: stopped. */
static inline double dem__draw_batch(const dem_world *w, dem__batch *b, dem_feed *feed, double number, double mass,
                                     ptrdiff_t n, int at_once) {
    const ptrdiff_t pieces = dem__feed_pieces(feed);
    double widest = 0.0;
    if (dem__draw_due(w, feed, number, mass, dem__most_drawn(at_once), b->radius) < 0) return -1.0;
    if (at_once) dem__sort_sizes(b->radius, n);
    for (ptrdiff_t k = 0; k < n * pieces; k++) {
        const double r = b->radius[k / pieces];
        b->piece[k] =
            feed->clump ? r * dem__feed_scale(feed) * feed->clump->radius[k % pieces] : r * dem__feed_reach(w, feed);
        widest = r > widest ? r : widest;
    }
    return widest;
}

/* Finds places for n bodies, and counts them in the feed by number or, with by_mass, by mass. at_once: bodies without a
   place are counted as missed; otherwise the first of them waits, and with it those after it. */
static inline void dem__find_places(dem_world *w, dem__room *room, dem_feed *feed, dem__batch *b, ptrdiff_t n,
                                    int by_mass, int at_once) {
    ptrdiff_t found = 0;
    for (ptrdiff_t k = 0; k < n; k++) {
        const double radius = b->radius[k], m = dem__sphere_mass(w, feed->material, radius);
        dem_vec x;
        dem_quaternion q = dem__quaternion(1.0, dem_vec3(0.0, 0.0, 0.0));
        if (dem__find_place(w, room, feed, radius, &x, &q)) {
            double *turn = b->turn + 4 * found;
            dem__settle_body(w, room, feed, x, q, radius);
            for (int a = 0; a < 3; a++) b->place[3 * found + a] = dem_axis(x, a);
            turn[0] = q.w, turn[1] = q.x, turn[2] = q.y, turn[3] = q.z;
            b->radius[found++] = radius;
            feed->placed_mass += m;
            if (by_mass) feed->due_mass -= at_once ? 0.0 : m;
            else feed->due -= at_once ? 0.0 : 1.0;
        } else if (room->stopped) return;
        else if (at_once) {
            feed->missed++;
            feed->missed_mass += m;
        } else {
            feed->waiting = 2.0 * radius;
            return;
        }
    }
}

/* Lists the placed bodies in the order of the cells of their first particles, so that neighbours in space are
   neighbours in memory. Returns their number. */
static inline ptrdiff_t dem__list_placed(const dem__room *room, ptrdiff_t present, dem_feed *feed, dem__batch *b) {
    const ptrdiff_t pieces = dem__feed_pieces(feed);
    ptrdiff_t placed = 0;
    for (ptrdiff_t c = 0; c < room->cells; c++) {
        for (int32_t q = room->head[c]; q >= present; q = room->next[q]) {
            const ptrdiff_t body = (q - present) / pieces;
            if ((q - present) % pieces != 0) continue;
            b->diameter[placed] = 2.0 * b->radius[body];
            for (int a = 0; a < 4; a++) b->orientation[4 * placed + a] = b->turn[4 * body + a];
            for (int a = 0; a < 3; a++) {
                b->centre[3 * placed + a] = b->place[3 * body + a];
                b->velocity[3 * placed + a] = dem_axis(feed->velocity, a) +
                                              dem_axis(feed->scatter, a) * (2.0 * dem__uniform(&feed->random) - 1.0);
            }
            placed++;
        }
    }
    return placed;
}

/* Adds n bodies with their velocities, or none. */
static inline dem_status dem__add_moving(dem_world *w, const dem_feed *feed, ptrdiff_t n, const dem__batch *b) {
    const ptrdiff_t pieces = dem__feed_pieces(feed);
    dem_status status;
    if (feed->polyhedron)
        status = w->engine->convex.calls->add(w, feed->polyhedron - 1, n, b->centre, b->orientation, feed->material,
                                              feed->group);
    else if (feed->clump)
        status =
            feed->clump->add__(w, n, feed->clump, b->centre, b->diameter, b->orientation, feed->material, feed->group);
    else status = dem_add_spheres(w, n, b->centre, b->diameter, feed->material, feed->group);
    for (ptrdiff_t k = 0; k < n && status == DEM_OK; k++) {
        const dem_vec v = dem_vec3(b->velocity[3 * k], b->velocity[3 * k + 1], b->velocity[3 * k + 2]);
        dem_set_motion(w, w->count - (n - k) * pieces, v, dem_vec3(0.0, 0.0, 0.0));
    }
    return status;
}

/* Draws n bodies, finds places for them, and lists those that have one; *placed: their number. */
static inline dem_status dem__place_batch(dem_world *w, dem_feed *feed, dem__batch *b, double number, double mass,
                                          ptrdiff_t n, int at_once, ptrdiff_t *placed) {
    dem__room room;
    const double widest = dem__draw_batch(w, b, feed, number, mass, n, at_once);
    if (widest < 0.0) return DEM_STOPPED;
    dem_status status = dem__make_room(&room, w, &feed->region, b->piece, n * dem__feed_pieces(feed),
                                       widest * dem__feed_reach(w, feed));
    if (status == DEM_OK) {
        const ptrdiff_t present = room.count;
        dem__find_places(w, &room, feed, b, n, mass < HUGE_VAL, at_once);
        *placed = dem__list_placed(&room, present, feed, b);
        if (room.stopped) status = DEM_STOPPED;
    }
    dem__clear_room(&room, w);
    return status;
}

/* Places a number of bodies or, if that is infinite, a mass. at_once: the largest first, and those without a place are
   missed; otherwise in the order drawn, up to the first without a place, which waits. */
static inline dem_status dem__insert(dem_world *w, dem_feed *feed, double number, double mass, int at_once) {
    if (dem__is_running(w)) return DEM_BUSY;
    const dem_allocator memory = w->def.allocator;
    dem_feed after = *feed, counted;
    if (feed->polyhedron) after.sizes = dem_one_size(dem__convex_diameter(dem__feed_shape(w, feed)));
    counted = after;
    dem__batch batch;
    ptrdiff_t placed = 0;
    const double most = (double)dem__most_drawn(at_once);
    double smallest, largest;
    memset(&batch, 0, sizeof batch);
    dem__are_sizes(&after.sizes, &smallest, &largest);
    if (at_once && number > most && mass > most * dem__sphere_mass(w, feed->material, 0.5 * largest))
        return DEM_TOO_MANY;
    w->engine->run.running = 1; /* def.stop finds the world busy */
    const int is_counted = at_once && number >= 1.0 && !(mass < HUGE_VAL);
    const ptrdiff_t n =
        is_counted ? (ptrdiff_t)number : dem__draw_due(w, &counted, number, mass, dem__most_drawn(at_once), NULL);
    dem_status status = n < 0 ? DEM_STOPPED : n >= INT32_MAX / 8 / dem__feed_pieces(feed) ? DEM_TOO_MANY : DEM_OK;
    if (status == DEM_OK && n > 0) {
        status = DEM_OUT_OF_MEMORY;
        if (dem__make_batch(&batch, &memory, n, dem__feed_pieces(feed)))
            status = dem__place_batch(w, &after, &batch, number, mass, n, at_once, &placed);
    }
    w->engine->run.running = 0;
    if (status == DEM_OK && n > 0) status = dem__add_moving(w, &after, placed, &batch);
    if (batch.radius) memory.fn(memory.user, batch.radius, batch.bytes, 0);
    if (status != DEM_OK) return status;
    after.placed += placed;
    *feed = n > 0 ? after : counted;
    return DEM_OK;
}

static inline int dem__is_feed(const dem_world *w, const dem_feed *f) {
    double smallest, largest;
    if (!w || !w->def.allocator.fn || !f || f->material < 0 || f->material >= w->def.materials || f->tries < 1 ||
        f->tries > 1000000)
        return 0;
    if (!dem__is_region(&f->region) || !dem__are_sizes(&f->sizes, &smallest, &largest)) return 0;
    if (!dem__is_size(w, f->material, smallest) || !dem__is_size(w, f->material, largest)) return 0;
    if (f->clump && !(dem__is_clump(f->clump) && f->clump->add__)) return 0;
    if (f->polyhedron < 0 || f->polyhedron > w->engine->convex.shapes || (f->polyhedron && f->clump)) return 0;
    if (f->waiting != 0.0 && !dem__is_size(w, f->material, f->waiting)) return 0;
    if (!dem__moderate_vec(f->velocity) || !dem__moderate_vec(f->scatter) ||
        !(f->scatter.x >= 0.0 && f->scatter.y >= 0.0) || !(f->scatter.z >= 0.0))
        return 0;
    if (f->placed < 0 || f->missed < 0 || f->placed > PTRDIFF_MAX / 2 || f->missed > PTRDIFF_MAX / 2) return 0;
    return dem__finite(f->due) && dem__finite(f->due_mass) && dem__finite(f->placed_mass) &&
           dem__finite(f->missed_mass);
}

DEM_API dem_status dem_fill(dem_world *world, dem_feed *feed, ptrdiff_t count) {
    if (!dem__is_feed(world, feed) || count < 0) return DEM_BAD_ARGUMENT;
    return dem__insert(world, feed, (double)count, HUGE_VAL, 1);
}
/* Returns a volume [m3] that the bodies placed in a region cannot exceed; of a mesh, that of the box around it. Where
   the region is flat, bodies stand out of it. */
static inline double dem__most_volume(const dem_world *w, const dem_feed *feed) {
    dem_region r = feed->region;
    double smallest, diameter;
    dem__are_sizes(&feed->sizes, &smallest, &diameter);
    if (feed->polyhedron) diameter = dem__convex_diameter(dem__feed_shape(w, feed));
    diameter *= dem__feed_reach(w, feed);
    if (r.kind == DEM_REGION_MESH) r.kind = DEM_REGION_BOX;
    if (r.kind == DEM_REGION_CYLINDER && r.length == 0.0) r.length = diameter;
    for (int a = 0; a < 3 && r.kind == DEM_REGION_BOX; a++) {
        if (!(dem_axis(r.high, a) > dem_axis(r.low, a)))
            *dem_axis_of(&r.low, a) = 0.0, *dem_axis_of(&r.high, a) = diameter;
    }
    return dem_region_volume(&r);
}
DEM_API dem_status dem_fill_mass(dem_world *world, dem_feed *feed, double mass) {
    if (!dem__is_feed(world, feed) || !dem__not_negative(mass)) return DEM_BAD_ARGUMENT;
    if (dem__is_running(world)) return DEM_BUSY;
    if (mass > world->def.material[feed->material].density * dem__most_volume(world, feed)) return DEM_TOO_MANY;
    return dem__insert(world, feed, HUGE_VAL, mass, 1);
}

DEM_API dem_status dem_feed_number(dem_world *world, dem_feed *feed, double rate, double duration) {
    if (!dem__is_feed(world, feed) || !dem__not_negative(rate) || !dem__not_negative(duration) ||
        !dem__finite(rate * duration))
        return DEM_BAD_ARGUMENT;
    dem_feed due = *feed;
    due.due += rate * duration;
    const dem_status status = dem__insert(world, &due, due.due, HUGE_VAL, 0);
    if (status == DEM_OK) *feed = due;
    return status;
}
DEM_API dem_status dem_feed_mass(dem_world *world, dem_feed *feed, double mass_flow, double duration) {
    if (!dem__is_feed(world, feed) || !dem__not_negative(mass_flow) || !dem__not_negative(duration) ||
        !dem__finite(mass_flow * duration))
        return DEM_BAD_ARGUMENT;
    dem_feed due = *feed;
    due.due_mass += mass_flow * duration;
    const dem_status status = dem__insert(world, &due, HUGE_VAL, due.due_mass, 0);
    if (status == DEM_OK) *feed = due;
    return status;
}
