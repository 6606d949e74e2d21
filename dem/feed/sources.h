/* Sources: fills and feeds of one class or several, at once or over time. */
#pragma once
#include "filling.h"

/* The classes of a source as they are before a call. */
static inline void dem__open_queues(const dem_world *w, const dem_source *source, dem__queue *line) {
    for (int k = 0; k < source->classes; k++) {
        const dem_feed *f = &source->feed[k];
        memset(&line[k], 0, sizeof line[k]);
        line[k].feed = *f, line[k].share = source->share ? source->share[k] : 1.0;
        line[k].given = source->by_number ? (double)(f->placed + f->missed) : f->placed_mass + f->missed_mass;
        if (f->polyhedron || f->compound) line[k].feed.sizes = dem_one_size(dem__feed_diameter(w, f));
    }
}

/* Places a number of bodies or, if that is infinite, a mass. at_once: the largest first, and those without a place
   are missed; otherwise in the order drawn, up to the first without a place, which waits. line: room for twice the
   classes. */
static inline dem_status dem__insert_lines(dem_world *w, dem_source *source, dem__queue *line, double number,
                                           double mass, int at_once) {
    const dem_allocator memory = w->def.allocator;
    dem__queue *after = line, *counted = line + source->classes;
    dem_source due = *source;
    dem__batch batch;
    const double most = (double)dem__most_drawn(at_once);
    double heaviest = 0.0;
    ptrdiff_t pieces = 1;
    memset(&batch, 0, sizeof batch);
    dem__open_queues(w, source, after);
    memcpy(counted, after, (size_t)source->classes * sizeof *after);
    for (int k = 0; k < source->classes; k++) {
        double smallest, largest;
        dem__are_sizes(&after[k].feed.sizes, &smallest, &largest);
        const double m = dem__sphere_mass(w, after[k].feed.material, 0.5 * largest);
        heaviest = m > heaviest ? m : heaviest;
        pieces = dem__feed_pieces(&after[k].feed) > pieces ? dem__feed_pieces(&after[k].feed) : pieces;
    }
    if (at_once && number > most && mass > most * heaviest) return DEM_TOO_MANY;
    w->engine->run.running = 1; /* functions of the caller must find the world busy */
    const int is_counted = at_once && number >= 1.0 && !(mass < HUGE_VAL);
    const ptrdiff_t n = is_counted
                            ? (ptrdiff_t)number
                            : dem__draw_due(w, counted, source, number, mass, dem__most_drawn(at_once), NULL, NULL);
    dem_status status = n < 0 ? DEM_STOPPED : n >= INT32_MAX / 8 / pieces ? DEM_TOO_MANY : DEM_OK;
    if (status == DEM_OK && n > 0) {
        status = DEM_OUT_OF_MEMORY;
        if (dem__make_batch(&batch, &memory, n, pieces))
            status = dem__place_batch(w, after, &due, &batch, number, mass, n, at_once);
    }
    w->engine->run.running = 0;
    if (status == DEM_OK && n > 0) status = dem__add_lines(w, after, source->classes, &batch);
    if (batch.radius) memory.fn(memory.user, batch.radius, batch.bytes, 0);
    if (status != DEM_OK) return status;
    *source = due;
    for (int k = 0; k < source->classes; k++) {
        const dem_sizes sizes = source->feed[k].sizes;
        source->feed[k] = n > 0 ? after[k].feed : counted[k].feed;
        source->feed[k].sizes = sizes;
    }
    return DEM_OK;
}

static inline dem_status dem__insert(dem_world *w, dem_source *source, double number, double mass, int at_once) {
    if (dem__is_running(w)) return DEM_BUSY;
    dem__queue two[2], *line = two;
    const dem_allocator memory = w->def.allocator;
    const size_t bytes = 2 * (size_t)source->classes * sizeof *line;
    if (source->classes > 1) line = (dem__queue *)memory.fn(memory.user, NULL, 0, bytes);
    if (!line) return DEM_OUT_OF_MEMORY;
    const dem_status status = dem__insert_lines(w, source, line, number, mass, at_once);
    if (source->classes > 1) memory.fn(memory.user, line, bytes, 0);
    return status;
}

/* Returns a feed as a source of one class. The feed stores what it owes. */
static inline dem_source dem__source_of(dem_feed *feed) {
    dem_source s;
    memset(&s, 0, sizeof s);
    s.feed = feed, s.classes = 1;
    s.due = feed->due, s.due_mass = feed->due_mass;
    return s;
}

/* Returns what is wrong with a feed, or NULL. */
static inline const char *dem__wrong_feed(const dem_world *w, const dem_feed *f) {
    double smallest, largest;
    if (!w || !w->def.allocator.fn) return "world: dem_init or dem_load has not made it";
    if (!f) return "feed: NULL";
    if (f->material < 0 || f->material >= w->def.materials)
        return "feed.material: the world has no material of this index";
    if (f->tries < 1 || f->tries > 1000000) return "feed.tries: not 1 .. 1000000";
    if (!dem__is_region(&f->region)) return "feed.region: a length, a place or an axis is out of range";
    if (!dem__are_sizes(&f->sizes, &smallest, &largest))
        return "feed.sizes: a diameter, a share, the scale or the spread is out of range, or has another unit";
    if (!dem__is_size(w, f->material, smallest) || !dem__is_size(w, f->material, largest))
        return "feed.sizes: mass or inertia of a body is not a normal number";
    if (f->clump && !(dem__is_clump(f->clump) && f->clump->add__))
        return "feed.clump: not one that dem_make_clump made";
    if (f->polyhedron < 0 || f->polyhedron > w->engine->convex.shapes)
        return "feed.polyhedron: neither 0 nor 1 + the index of a shape of the world";
    if (f->polyhedron && f->clump) return "feed.polyhedron: the feed also has a clump";
    if (f->compound && (f->polyhedron || f->clump)) return "feed.compound: the feed also has a polyhedron or a clump";
    if (f->compound && !(dem__is_compound(w, f->compound) && f->compound->add__))
        return "feed.compound: not one that dem_make_compound made with this world";
    if (f->waiting != 0.0 && !dem__is_size(w, f->material, f->waiting)) return "feed.waiting: neither 0 nor a diameter";
    if (!dem__moderate_vec(f->velocity)) return "feed.velocity: a component is not finite or above 1e80";
    if (!dem__moderate_vec(f->scatter) || !(f->scatter.x >= 0.0 && f->scatter.y >= 0.0) || !(f->scatter.z >= 0.0))
        return "feed.scatter: a component is below 0, not finite or above 1e80";
    if (f->placed < 0 || f->placed > PTRDIFF_MAX / 2) return "feed.placed: below 0 or too large";
    if (f->missed < 0 || f->missed > PTRDIFF_MAX / 2) return "feed.missed: below 0 or too large";
    return dem__finite(f->due) && dem__finite(f->due_mass) && dem__finite(f->placed_mass) && dem__finite(f->missed_mass)
               ? NULL
               : "feed.due, due_mass, placed_mass, missed_mass: one is not finite";
}

/* Each of these returns whether a call cannot be done, and then stores why. */
static inline int dem__is_bad_feed(dem_world *w, const dem_feed *f) {
    const char *wrong = dem__wrong_feed(w, f);
    return wrong && dem__refuse(w, wrong);
}
static inline int dem__is_bad_number(dem_world *w, ptrdiff_t count) {
    return count < 0 && dem__refuse(w, "count: below 0");
}
static inline int dem__is_bad_mass(dem_world *w, double mass) {
    return !dem__not_negative(mass) && dem__refuse(w, "mass: below 0 or not finite");
}
static inline int dem__is_bad_flow(dem_world *w, double rate, double duration, const char *wrong) {
    if (!dem__not_negative(rate)) return (int)dem__refuse(w, wrong);
    if (!dem__not_negative(duration)) return (int)dem__refuse(w, "duration: below 0 or not finite");
    return !dem__finite(rate * duration) && dem__refuse(w, "duration: what is due in it is not finite");
}

DEM_API dem_status dem_fill(dem_world *world, dem_feed *feed, ptrdiff_t count) {
    if (dem__is_bad_feed(world, feed) || dem__is_bad_number(world, count)) return DEM_BAD_ARGUMENT;
    dem_source source = dem__source_of(feed);
    return dem__insert(world, &source, (double)count, HUGE_VAL, 1);
}
/* Returns a volume [m3] that the bodies placed in a region cannot exceed; for a mesh, that of its bounding box. Bodies
   protrude from a flat region. */
static inline double dem__most_volume(const dem_world *w, const dem_feed *feed) {
    dem_region r = feed->region;
    double smallest, diameter;
    dem__are_sizes(&feed->sizes, &smallest, &diameter);
    if (feed->polyhedron || feed->compound) diameter = dem__feed_diameter(w, feed);
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
    if (dem__is_bad_feed(world, feed) || dem__is_bad_mass(world, mass)) return DEM_BAD_ARGUMENT;
    if (dem__is_running(world)) return DEM_BUSY;
    if (mass > world->def.material[feed->material].density * dem__most_volume(world, feed)) return DEM_TOO_MANY;
    dem_source source = dem__source_of(feed);
    return dem__insert(world, &source, HUGE_VAL, mass, 1);
}

DEM_API dem_status dem_feed_number(dem_world *world, dem_feed *feed, double rate, double duration) {
    if (dem__is_bad_feed(world, feed) || dem__is_bad_flow(world, rate, duration, "rate: below 0 or not finite"))
        return DEM_BAD_ARGUMENT;
    dem_source source = dem__source_of(feed);
    source.due += rate * duration;
    const dem_status status = dem__insert(world, &source, source.due, HUGE_VAL, 0);
    if (status == DEM_OK) feed->due = source.due;
    return status;
}
DEM_API dem_status dem_feed_mass(dem_world *world, dem_feed *feed, double mass_flow, double duration) {
    if (dem__is_bad_feed(world, feed) ||
        dem__is_bad_flow(world, mass_flow, duration, "mass_flow: below 0 or not finite"))
        return DEM_BAD_ARGUMENT;
    dem_source source = dem__source_of(feed);
    source.due_mass += mass_flow * duration;
    const dem_status status = dem__insert(world, &source, HUGE_VAL, source.due_mass, 0);
    if (status == DEM_OK) feed->due_mass = source.due_mass;
    return status;
}

static inline const char *dem__wrong_source(const dem_world *w, const dem_source *s) {
    double sum = 0.0;
    if (!w || !w->def.allocator.fn) return "world: dem_init or dem_load has not made it";
    if (!s) return "source: NULL";
    if (!s->feed) return "source.feed: NULL";
    if (!s->share) return "source.share: NULL";
    if (s->classes < 1 || s->classes > DEM_CLASSES_MAX) return "source.classes: not 1 .. 100000";
    for (int k = 0; k < s->classes; k++) {
        const char *wrong = dem__wrong_feed(w, &s->feed[k]);
        if (wrong) return wrong;
        if (!dem__not_negative(s->share[k])) return "source.share: one is below 0 or not finite";
        sum += s->share[k];
    }
    if (!dem__positive(sum)) return "source.share: the sum is 0 or not finite";
    return dem__finite(s->due) && dem__finite(s->due_mass) ? NULL : "source.due, due_mass: one is not finite";
}
static inline int dem__is_bad_source(dem_world *w, const dem_source *s) {
    const char *wrong = dem__wrong_source(w, s);
    return wrong && dem__refuse(w, wrong);
}
DEM_API dem_status dem_fill_source(dem_world *world, dem_source *source, ptrdiff_t count) {
    if (dem__is_bad_source(world, source) || dem__is_bad_number(world, count)) return DEM_BAD_ARGUMENT;
    return dem__insert(world, source, (double)count, HUGE_VAL, 1);
}
DEM_API dem_status dem_fill_source_mass(dem_world *world, dem_source *source, double mass) {
    if (dem__is_bad_source(world, source) || dem__is_bad_mass(world, mass)) return DEM_BAD_ARGUMENT;
    if (dem__is_running(world)) return DEM_BUSY;
    double most = 0.0;
    for (int k = 0; k < source->classes; k++) {
        dem_feed feed = source->feed[k];
        feed.region = source->feed[0].region;
        const double here = world->def.material[feed.material].density * dem__most_volume(world, &feed);
        most = here > most ? here : most;
    }
    if (mass > most) return DEM_TOO_MANY;
    return dem__insert(world, source, HUGE_VAL, mass, 1);
}
DEM_API dem_status dem_feed_source(dem_world *world, dem_source *source, double rate, double duration) {
    if (dem__is_bad_source(world, source) || dem__is_bad_flow(world, rate, duration, "rate: below 0 or not finite"))
        return DEM_BAD_ARGUMENT;
    dem_source due = *source;
    due.due += rate * duration;
    const dem_status status = dem__insert(world, &due, due.due, HUGE_VAL, 0);
    if (status == DEM_OK) *source = due;
    return status;
}
DEM_API dem_status dem_feed_source_mass(dem_world *world, dem_source *source, double mass_flow, double duration) {
    if (dem__is_bad_source(world, source) ||
        dem__is_bad_flow(world, mass_flow, duration, "mass_flow: below 0 or not finite"))
        return DEM_BAD_ARGUMENT;
    dem_source due = *source;
    due.due_mass += mass_flow * duration;
    const dem_status status = dem__insert(world, &due, HUGE_VAL, due.due_mass, 0);
    if (status == DEM_OK) *source = due;
    return status;
}
