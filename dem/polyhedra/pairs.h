/* Contacts of polyhedra: which pairs may have contacts, their points in a step, and the contacts that follow these
   points, begin and end. Reads bodies, walls and the list of near pairs; writes pairs, contacts and their places.
   Promises: a contact depends only on its pair and step, never on earlier tests or on threads. A contact of pair q has
   near = -2 - q. */
#pragma once
#include "../search/bounds.h"
#include "compound_pairs.h"

/* Places a polyhedron at a step. */
static inline void dem__place_polyhedron(dem_world *w, ptrdiff_t i, int64_t step) {
    dem__rigid *r = dem__rigid_of(w, i);
    const double tau = (double)(step - w->particle[i].origin) * w->engine->run.dt;
    const dem_quaternion of_body = dem__body_turn_at(w, i, tau), turn = dem__turn_of_polyhedron(w, i, of_body);
    dem__placed *place = &w->engine->convex.place[i];
    dem_vec x = dem__body_at(r, tau);
    if (dem__is_part(w, i)) x = dem__add(x, dem__to_lab(of_body, w->engine->bodies.offset[i]));
    else if (w->engine->bodies.activity[i] != DEM__FLYING) r->rotation_steps = -1.0, r->ahead = of_body;
    place->x = dem__in_box(w, x);
    place->axis[0] = dem__first_axis(turn), place->axis[1] = dem__second_axis(turn),
    place->axis[2] = dem__third_axis(turn);
}
/* Places the particles among first .. end-1 that take steps. */
static inline void dem__place_active(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    (void)part;
    for (ptrdiff_t i = first; i < end; i++) {
        if (w->alive[i] && w->engine->bodies.activity[i] != DEM__FLYING && dem__shape_of(w, i))
            dem__place_polyhedron(w, i, *(const int64_t *)context);
    }
}
/* Places the particles among first .. end-1 that are in flight and marked in scratch.index. */
static inline void dem__place_flying(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    (void)part;
    for (ptrdiff_t i = first; i < end; i++) {
        if (w->engine->scratch.index[i] && w->engine->bodies.activity[i] == DEM__FLYING && dem__shape_of(w, i))
            dem__place_polyhedron(w, i, *(const int64_t *)context);
    }
}

/* ---- pairs that are close ---- */

/* A list of pairs that several threads make: part p of the loop has put `count[p]` of them, the first at `first[p]`. */
typedef struct dem__pair_list {
    int64_t step;
    ptrdiff_t first[DEM__PARTS_MAX], count[DEM__PARTS_MAX];
} dem__pair_list;

/* Returns whether one of a pair's bodies is in flight. */
DEM_INLINE int dem__has_flying(const dem_world *w, const dem__convex_pair *p) {
    const int32_t *activity = w->engine->bodies.activity;
    return activity[p->i] == DEM__FLYING || (p->j >= 0 && activity[p->j] == DEM__FLYING);
}

/* Finds whether pair k is close at a step. */
static inline void dem__look_at_pair(dem_world *w, ptrdiff_t k, int64_t step) {
    dem__convex_pair *p = &w->engine->convex.pair[k];
    if (dem__is_skipped(w, p, step)) return;
    p->is_close = p->count = 0, p->skip_until = 0;
    if (!w->alive[p->i] || (p->j >= 0 && !w->alive[p->j])) return;
    if (p->j < 0) dem__look_at_wall(w, p, step);
    else dem__look_at_spheres(w, p, step);
}

/* Lists those of pairs first .. end-1 that are close at a step, and the first pairs of compounds. Pair k with a body in
   flight is -1 - k. */
static inline void dem__find_close(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    dem__pair_list *list = (dem__pair_list *)context;
    int32_t *close = w->engine->convex.close;
    ptrdiff_t n = first;
    for (ptrdiff_t k = first; k < end; k++) { /* by index: without pairs there is no array */
        const dem__convex_pair *p = &w->engine->convex.pair[k];
        dem__look_at_pair(w, k, list->step);
        if (p->is_close || p->lead == k) close[n++] = (int32_t)(p->is_close && dem__has_flying(w, p) ? -1 - k : k);
    }
    list->first[part] = first, list->count[part] = n - first;
}

/* Joins the parts of a list, and marks the bodies of pairs that have one in flight. */
static inline void dem__join_close(dem_world *w, const dem__pair_list *list, int parts) {
    dem__convex_state *convex = &w->engine->convex;
    int32_t *marked = w->engine->scratch.index;
    convex->closes = 0;
    for (int q = 0; q < parts; q++) {
        for (ptrdiff_t m = list->first[q]; m < list->first[q] + list->count[q]; m++) {
            const int32_t k = convex->close[m] < 0 ? -1 - convex->close[m] : convex->close[m];
            const dem__convex_pair *p = &convex->pair[k];
            if (convex->close[m] < 0) marked[p->i] = 1;
            if (convex->close[m] < 0 && p->j >= 0) marked[p->j] = 1;
            convex->close[convex->closes++] = k;
        }
    }
}

/* Lists the pairs that are close at a step, and places their polyhedra. */
static inline void dem__place_close(dem_world *w, int64_t step) {
    const dem__convex_state *convex = &w->engine->convex;
    const int parts = dem__parts(w, w->count), pair_parts = dem__parts(w, convex->pairs);
    const int some_fly = w->engine->bodies.active_count < w->count - w->engine->bodies.dropped;
    dem__pair_list list;
    list.step = step;
    dem__in_parts(w, parts, w->count, dem__place_active, &step);
    dem__in_parts(w, pair_parts, convex->pairs, dem__find_close, &list);
    for (ptrdiff_t i = 0; some_fly && i < w->count; i++) w->engine->scratch.index[i] = 0;
    dem__join_close(w, &list, pair_parts);
    if (some_fly) dem__in_parts(w, parts, w->count, dem__place_flying, &step);
}

/* ---- points ---- */

/* A test of all pairs by several threads, each of which has a share of the points. */
typedef struct dem__convex_look {
    int64_t step, overlaps[DEM__PARTS_MAX], cuts[DEM__PARTS_MAX];
    ptrdiff_t share;
    int full[DEM__PARTS_MAX];
} dem__convex_look;
/* Finds the points of close pairs first .. end-1 at a step. look->full: they do not fit into this part. */
static inline void dem__look_at_polyhedra(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    dem__convex_look *look = (dem__convex_look *)context;
    dem__convex_state *convex = &w->engine->convex;
    ptrdiff_t at = look->share * part;
    const ptrdiff_t limit = at + look->share;
    look->overlaps[part] = look->cuts[part] = look->full[part] = 0;
    for (ptrdiff_t k = first; k < end; k++) {
        const int32_t q = convex->close[k];
        dem__convex_pair *p = &convex->pair[q];
        if (p->lead >= 0) { /* with the other pairs of two bodies */
            const ptrdiff_t n = p->lead != q ? 0
                                             : dem__points_of_bodies(w, q, look->step, at, limit, &look->overlaps[part],
                                                                     &look->cuts[part]);
            if (n < 0) {
                look->full[part] = 1;
                return;
            }
            at += n;
            continue;
        }
        p->first = (int32_t)at;
        if (limit - at < DEM__POINTS_MAX) {
            look->full[part] = 1;
            return;
        }
        if (p->j < 0) p->count = dem__points_at_wall(w, p, look->step, convex->point + at, &look->cuts[part]);
        else p->count = dem__points_of_pair(w, p, look->step, convex->point + at, &look->overlaps[part]);
        at += p->count;
    }
}

/* Makes room for `wanted` points, which loses their contents. Returns 0 when out of memory. */
static inline int dem__grow_points(dem_world *w, ptrdiff_t wanted) {
    dem__convex_state *convex = &w->engine->convex;
    const dem_allocator *a = &w->def.allocator;
    if (wanted <= convex->point_capacity) return 1;
    if (wanted > INT32_MAX / 2) return 0;
    dem__convex_point *fresh = (dem__convex_point *)a->fn(a->user, NULL, 0, (size_t)wanted * sizeof *fresh);
    if (!fresh) return 0;
    dem__release(a, convex->point, (size_t)convex->point_capacity * sizeof *fresh);
    convex->point = fresh, convex->point_capacity = wanted;
    return 1;
}

/* Finds the points of all pairs at a step. Returns 0 when out of memory. */
static inline int dem__find_convex_points(dem_world *w, int64_t step) {
    dem__convex_state *convex = &w->engine->convex;
    dem__convex_look look;
    int full = 1;
    look.step = step;
    dem__place_close(w, step);
    const int parts = dem__parts(w, convex->closes);
    if (!dem__grow_points(w, 2 * (w->engine->contacts.count + DEM__POINTS_MAX * (ptrdiff_t)parts))) return 0;
    while (full) {
        full = 0;
        look.share = convex->point_capacity / parts;
        dem__in_parts(w, parts, convex->closes, dem__look_at_polyhedra, &look);
        for (int q = 0; q < parts; q++) full |= look.full[q];
        if (full && !dem__grow_points(w, 2 * convex->point_capacity)) return 0;
    }
    convex->overlaps = 0;
    for (int q = 0; q < parts; q++) {
        convex->overlaps += look.overlaps[q];
        convex->overlap_steps += look.overlaps[q] + look.cuts[q];
    }
    return 1;
}

DEM_INLINE void dem__set_place(dem_world *w, ptrdiff_t c, const dem__convex_point *p) {
    double *const *place = w->engine->contacts.touch;
    dem__set_place_vec(w, DEM__PLACE_NORMAL, c, p->normal);
    dem__set_place_vec(w, DEM__PLACE_ARM, c, p->at);
    place[DEM__PLACE_GAP][c] = p->gap, place[DEM__PLACE_WEIGHT][c] = p->weight;
    place[DEM__PLACE_DAMPING][c] = p->damping, place[DEM__PLACE_PULL][c] = p->pull;
}

/* Sets the place where the contact in slot c begins: also the normal one step before, and the curvature of a wall,
   which the contact keeps. */
static inline void dem__set_first_place(dem_world *w, ptrdiff_t c, const dem__convex_point *p) {
    const dem__contacts *contacts = &w->engine->contacts;
    const ptrdiff_t i = contacts->i[c], j = contacts->j[c];
    dem__touch touch;
    touch.curvature = 0.0;
    if (j < 0 && !dem__has(&w->wall[-1 - j], DEM__TRIANGULATED)) {
        const dem_wall *wall = &w->wall[-1 - j];
        dem__touch_element(wall, dem__add(w->engine->convex.place[i].x, p->at), dem__touching_radius(w, i),
                           dem__element_of_key(wall, p->key), &touch);
    }
    dem__set_place(w, c, p);
    contacts->touch[DEM__PLACE_CURVATURE][c] = touch.curvature;
    contacts->touch[DEM__PLACE_WAS][c] = p->weight;
    dem__set_place_vec(w, DEM__PLACE_BEFORE, c, p->normal);
}

/* Moves the contacts of chunks first .. end-1 to their points of this step. A contact that has lost its point gets a
   gap above 0, and so ends. */
static inline void dem__follow_points(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    dem__contacts *contacts = &w->engine->contacts;
    (void)part, (void)context;
    for (const dem__chunk *in = contacts->chunk + first; in < contacts->chunk + end; in++) {
        for (ptrdiff_t c = in->first; c < in->first + in->count; c++) {
            if (!dem__is_convex_contact(w, c)) continue;
            const dem__convex_pair *p = &w->engine->convex.pair[-2 - contacts->near[c]];
            dem__convex_point *point = w->engine->convex.point + p->first, *stop = point + p->count;
            dem__set_place_vec(w, DEM__PLACE_BEFORE, c, dem__place_normal(w, c));
            contacts->touch[DEM__PLACE_WAS][c] = contacts->touch[DEM__PLACE_WEIGHT][c];
            while (point < stop && point->key != contacts->element[c]) point++;
            if (point < stop) {
                dem__set_place(w, c, point);
                point->taken = 1;
            } else
                contacts->touch[DEM__PLACE_GAP][c] = w->particle[p->i].radius,
                contacts->touch[DEM__PLACE_PULL][c] = 0.0;
        }
    }
}

/* Returns whether a pair has a point without a contact. */
DEM_INLINE int dem__has_new_point(const dem__convex_state *convex, const dem__convex_pair *p) {
    int taken = 1;
    for (int32_t k = p->first; k < p->first + p->count; k++) taken &= convex->point[k].taken;
    return !taken;
}

/* Keeps those of close pairs first .. end-1 that have a point without a contact. */
static inline void dem__find_new_points(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    dem__pair_list *list = (dem__pair_list *)context;
    int32_t *close = w->engine->convex.close;
    ptrdiff_t n = first;
    for (ptrdiff_t k = first; k < end; k++) {
        if (dem__has_new_point(&w->engine->convex, &w->engine->convex.pair[close[k]])) close[n++] = close[k];
    }
    list->first[part] = first, list->count[part] = n - first;
}

/* Begins the contacts of points that have none. Returns 0 when out of memory. */
static inline int dem__begin_at_points(dem_world *w, ptrdiff_t q) {
    const dem__convex_state *convex = &w->engine->convex;
    const dem__convex_pair *p = &convex->pair[q];
    for (const dem__convex_point *point = convex->point + p->first; point < convex->point + p->first + p->count;
         point++) {
        if (point->taken) continue;
        if (!dem__new_contact(w, p->i, p->j, point->key, (int32_t)(-2 - q))) return 0;
        dem__set_first_place(w, dem__next_slot(w) - 1, point);
    }
    return 1;
}

/* Moves the contacts of polyhedra to a step to which the walls have been moved, and begins new ones. */
static inline void dem__follow_polyhedra(dem_world *w, int64_t step) {
    const dem__convex_state *convex = &w->engine->convex;
    const dem__contacts *contacts = &w->engine->contacts;
    dem__pair_list list;
    if (!dem__find_convex_points(w, step)) {
        w->status = DEM_OUT_OF_MEMORY;
        return;
    }
    const int parts = dem__parts(w, convex->closes);
    dem__in_parts(w, dem__parts_of(w, contacts->count, contacts->chunk_count), contacts->chunk_count,
                  dem__follow_points, NULL);
    dem__in_parts(w, parts, convex->closes, dem__find_new_points, &list);
    for (int q = 0; q < parts; q++) {
        for (ptrdiff_t k = list.first[q]; k < list.first[q] + list.count[q]; k++) {
            if (!dem__begin_at_points(w, convex->close[k])) return;
        }
    }
}

/* Returns the pair of particle i with j, or with wall -1 - j; -1 if it is not listed. */
static inline ptrdiff_t dem__convex_pair_of(const dem_world *w, int32_t i, int32_t j) {
    const dem__convex_state *convex = &w->engine->convex;
    const int32_t near_pair = j < 0 ? -1 : dem__near_pair(w, i, j);
    ptrdiff_t low = j < 0 ? convex->of_particles : 0, high = j < 0 ? convex->pairs : convex->of_particles;
    if (j >= 0 && near_pair < 0) return -1;
    while (low < high) {
        const ptrdiff_t middle = (low + high) / 2;
        const dem__convex_pair *p = &convex->pair[middle];
        const int before = j >= 0 ? p->near < near_pair : p->i != i ? p->i < i : -1 - p->j < -1 - j;
        if (before) low = middle + 1;
        else high = middle;
    }
    const dem__convex_pair *p = &convex->pair[low];
    return low < (j < 0 ? convex->pairs : convex->of_particles) && p->i == i && p->j == j ? low : -1;
}

/* Lists the pairs, or with pair == NULL counts them. Returns how many. */
static inline ptrdiff_t dem__put_convex_pairs(const dem_world *w, dem__convex_pair *pair, ptrdiff_t *of_particles) {
    ptrdiff_t n = 0;
    dem__convex_pair p;
    memset(&p, 0, sizeof p);
    p.lead = p.next = -1;
    for (ptrdiff_t k = 0; k < w->engine->pairs.count; k++) {
        const dem__near *q = &w->engine->pairs.near[k];
        if (!dem__shape_of(w, q->i) && !dem__shape_of(w, q->j)) continue;
        p.i = q->i, p.j = q->j, p.near = (int32_t)k;
        if (pair) pair[n] = p, dem__stop_timer(&w->engine->pairs.timers, (int32_t)k);
        n++;
    }
    *of_particles = n;
    for (int32_t i = 0; i < (int32_t)w->count; i++) {
        for (int k = 0; k < w->walls && w->alive[i] && dem__shape_of(w, i) && !dem__is_fixed(w, i); k++) {
            if (!dem__has_surface(&w->wall[k])) continue;
            p.i = i, p.j = -1 - k, p.near = -1;
            if (pair) pair[n] = p;
            n++;
        }
    }
    return n;
}

static inline void dem__release_pairs(const dem_world *w) {
    const dem__convex_state *convex = &w->engine->convex;
    dem__release(&w->def.allocator, convex->pair, (size_t)convex->pair_capacity * sizeof *convex->pair);
    dem__release(&w->def.allocator, convex->close, (size_t)convex->pair_capacity * sizeof *convex->close);
}

/* Lists the pairs again, stops their tests as spheres, and finds the pair of each contact. Returns 0 when out of
   memory. */
static inline int dem__list_convex_pairs(dem_world *w) {
    dem__convex_state *convex = &w->engine->convex;
    dem__contacts *contacts = &w->engine->contacts;
    const dem_allocator *a = &w->def.allocator;
    const ptrdiff_t n = dem__put_convex_pairs(w, NULL, &convex->of_particles);
    for (int k = 0; k < w->walls; k++) {
        if (w->wall[k].tree && !dem__make_mesh_edges(a, w->wall[k].tree)) return 0;
    }
    if (n > INT32_MAX / 2) return 0;
    if (n > convex->pair_capacity) {
        const ptrdiff_t larger = n + n / 4 + 64;
        dem__convex_pair *fresh = (dem__convex_pair *)a->fn(a->user, NULL, 0, (size_t)larger * sizeof *fresh);
        int32_t *close = fresh ? (int32_t *)a->fn(a->user, NULL, 0, (size_t)larger * sizeof *close) : NULL;
        if (!close) {
            dem__release(a, fresh, (size_t)larger * sizeof *fresh);
            return 0;
        }
        dem__release_pairs(w);
        convex->pair = fresh, convex->close = close, convex->pair_capacity = larger;
    }
    convex->pairs = dem__put_convex_pairs(w, convex->pair, &convex->of_particles);
    dem__chain_pairs(w);
    DEM__EACH_CONTACT(w, c) {
        const int32_t i = contacts->i[c], j = contacts->j[c];
        if (!dem__shape_of(w, i) && (j < 0 || !dem__shape_of(w, j))) continue;
        const ptrdiff_t q = dem__convex_pair_of(w, i, j);
        contacts->near[c] = (int32_t)(-2 - q);
        if (q < 0) contacts->ended[c] = 1; /* cannot happen, because they touch */
    }
    return 1;
}
