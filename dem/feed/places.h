/* Where bodies of a source find room: shapes of bodies, free places by random tries. Pure functions but for the
   generator. */
#pragma once
#include "room.h"

/* Draws a place at which a sphere lies inside a region; in directions in which the region is flat, only its centre
   does. Returns 0 if the region is too small. */
static inline int dem__random_place(const dem_region *r, double radius, uint64_t *random, dem_vec *x) {
    if (r->kind == DEM_REGION_BOX || r->kind == DEM_REGION_MESH) { /* mesh: in its bounding box */
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
static inline ptrdiff_t dem__feed_pieces(const dem_feed *feed) {
    return feed->clump ? feed->clump->spheres : feed->compound ? feed->compound->parts : 1;
}
/* Returns the number of spheres for which a body of a feed finds a place: one around a polyhedron or a compound, so
   that compounds do not grow into each other. */
static inline ptrdiff_t dem__feed_balls(const dem_feed *feed) { return feed->clump ? feed->clump->spheres : 1; }
/* Returns the polyhedron of a feed, or NULL. */
static inline const dem_convex *dem__feed_shape(const dem_world *w, const dem_feed *feed) {
    return feed->polyhedron > 0 ? &w->engine->convex.shape[feed->polyhedron - 1] : NULL;
}
/* Returns the diameter of the sphere with the volume of a feed's polyhedron or compound; 0: bodies have the sizes of
   the feed. */
static inline double dem__feed_diameter(const dem_world *w, const dem_feed *feed) {
    const dem_convex *s = dem__feed_shape(w, feed);
    const double volume = s ? s->volume : feed->compound ? feed->compound->volume : 0.0;
    return volume > 0.0 ? 2.0 * riddle_cbrt(volume / (4.0 / 3.0 * RIDDLE_PI)) : 0.0;
}
/* Returns the factor by which a clump's lengths are multiplied in a body whose volume is that of a sphere of radius
   1. */
static inline double dem__feed_scale(const dem_feed *feed) {
    return feed->clump ? 2.0 / dem_clump_diameter(feed->clump) : 1.0;
}
/* Returns the radius of such a body about its centre. */
static inline double dem__feed_reach(const dem_world *w, const dem_feed *feed) {
    const dem_convex *s = dem__feed_shape(w, feed);
    if (s) return 2.0 * s->reach / dem__feed_diameter(w, feed);
    if (feed->compound) return 2.0 * dem__compound_reach(w, feed->compound) / dem__feed_diameter(w, feed);
    return feed->clump ? dem__feed_scale(feed) * dem__clump_reach(feed->clump) : 1.0;
}

/* Returns the position of particle k of a clump in a body with the volume of a sphere of the given radius. piece: the
   particle's radius. */
static inline dem_vec dem__piece_place(const dem_world *w, const dem_feed *feed, dem_vec x, dem_quaternion turn,
                                       double radius, int k, double *piece) {
    const double scale = radius * dem__feed_scale(feed);
    *piece = scale * feed->clump->radius[k];
    return dem__in_box(w, dem__plus(x, scale, dem__to_lab(turn, feed->clump->centre[k])));
}

/* Returns whether there is room for a body of a feed at x. */
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

/* Finds a free place for a body of a feed by random tries in the region of its source, with the source's generator.
   Returns 0 if there is none. */
static inline int dem__find_place(dem_world *w, dem__room *room, dem_feed *source, const dem_feed *feed, double radius,
                                  dem_vec *x, dem_quaternion *turn) {
    const double reach = radius * dem__feed_reach(w, feed);
    for (int tries = 0; tries < source->tries; tries++) {
        if (dem__is_stopped(w, room->looked++)) {
            room->stopped = 1;
            return 0;
        }
        if (!dem__random_place(&source->region, reach, &source->random, x)) return 0;
        *x = dem__in_box(w, *x); /* as dem_add_spheres does */
        if (feed->clump || feed->polyhedron || feed->compound) *turn = dem__random_turn(&source->random);
        if (dem__has_room(w, room, feed, *x, *turn, radius)) return 1;
    }
    return 0;
}

/* Adds the particles of a body to the lists, in their order. */
static inline void dem__settle_body(const dem_world *w, dem__room *room, const dem_feed *feed, dem_vec x,
                                    dem_quaternion turn, double radius) {
    if (!feed->clump) dem__occupy(room, x, radius * dem__feed_reach(w, feed));
    for (int k = 0; feed->clump && k < feed->clump->spheres; k++) {
        double piece;
        const dem_vec at = dem__piece_place(w, feed, x, turn, radius, k, &piece);
        dem__occupy(room, at, piece);
    }
}
