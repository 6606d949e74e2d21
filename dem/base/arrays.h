/* Memory: blocks of arrays that grow together, and the tables of those arrays. */
#pragma once
#include "refuse.h"

static inline void *dem__default_allocator(void *user, void *old, size_t old_size, size_t new_size) {
    (void)user;
    (void)old_size;
    if (new_size > 0) return realloc(old, new_size);
    free(old);
    return NULL;
}

/* Returns the shape of particle i, or NULL if it is a sphere. */
DEM_INLINE const dem_convex *dem__shape_of(const dem_world *w, ptrdiff_t i) {
    const dem__convex_state *convex = &w->engine->convex;
    return convex->shapes > 0 && convex->shape_of[i] > 0 ? &convex->shape[convex->shape_of[i] - 1] : NULL;
}

/* Returns whether particle i is a part of a compound: a polyhedron with a place and a turn of its own in its body. */
DEM_INLINE int dem__is_part(const dem_world *w, ptrdiff_t i) {
    const dem__convex_state *convex = &w->engine->convex;
    if (!convex->has_parts) return 0;
    const dem_quaternion *q = &convex->part[i];
    return q->w != 0.0 || q->x != 0.0 || q->y != 0.0 || q->z != 0.0;
}

/* Returns the least distance of a face of a core from its centre [m]. */
static inline double dem__half_width(const dem_convex *s) {
    double least = s->reach;
    for (int f = 0; f < s->faces; f++) least = s->plane[f][3] < least ? s->plane[f][3] : least;
    return least;
}
/* Returns how far particle i may move in a step [m]: half its radius, or less for a thin polyhedron, which could
   otherwise pass a sheet uncut. */
DEM_INLINE double dem__longest_step(const dem_world *w, ptrdiff_t i) {
    const dem_convex *s = dem__shape_of(w, i);
    const double half = 0.5 * w->particle[i].radius, width = s ? 2.0 * dem__half_width(s) : half;
    return width < half ? width : half;
}

/* Returns the radius with which particle i touches: its own, or that of its rounding. */
DEM_INLINE double dem__touching_radius(const dem_world *w, ptrdiff_t i) {
    const dem_convex *s = dem__shape_of(w, i);
    return s ? s->radius : w->particle[i].radius;
}

/* Returns by how many springs a contact of particle i may act, of which a corner has one. */
DEM_INLINE double dem__springs_of(const dem_world *w, ptrdiff_t i) {
    const dem_convex *s = dem__shape_of(w, i);
    return s ? (double)s->springs : 1.0;
}

/* Returns by what factor a contact of particle i may be stiffer than its spring and masses tell, because a polyhedron
   turns. */
DEM_INLINE double dem__rate_of(const dem_world *w, ptrdiff_t i) {
    const dem_convex *s = dem__shape_of(w, i);
    return s ? s->rate : 1.0;
}

/* Returns whether i or j is a polyhedron; j < 0: a wall. */
DEM_INLINE int dem__has_polyhedron(const dem_world *w, ptrdiff_t i, ptrdiff_t j) {
    return dem__shape_of(w, i) || (j >= 0 && dem__shape_of(w, j));
}

/* Lists the arrays of particles. Returns their number. */
static inline int dem__particle_arrays(dem_world *w, dem__array *list) {
    dem__bodies *bodies = &w->engine->bodies;
    int n = 0;
    double **doubles[] = {&bodies->wall_speed, &bodies->shifted, &bodies->mass_share};
    dem__two_vec **sixes[] = {&bodies->load, &bodies->external};
    int32_t **integers[] = {&w->material,
                            &w->group,
                            &w->alive,
                            &w->touching,
                            &bodies->active,
                            &bodies->active_at,
                            &w->engine->walls.first_contact,
                            &w->engine->pairs.adjacent_start,
                            &w->engine->pairs.cell_of,
                            &w->engine->scratch.index,
                            &bodies->activity,
                            &bodies->number,
                            &bodies->rank,
                            &bodies->by_rank,
                            &bodies->given,
                            &bodies->to_check};
    for (size_t k = 0; k < sizeof doubles / sizeof *doubles; k++, n++) {
        list[n].address = doubles[k], list[n].size = sizeof(double);
    }
    for (size_t k = 0; k < sizeof sixes / sizeof *sixes; k++, n++) {
        list[n].address = sixes[k], list[n].size = sizeof(dem__two_vec);
    }
    for (size_t k = 0; k < sizeof integers / sizeof *integers; k++, n++) {
        list[n].address = integers[k], list[n].size = sizeof(int32_t);
    }
    list[n].address = &w->particle, list[n++].size = sizeof(dem_particle);
    list[n].address = &w->spin_rate, list[n++].size = sizeof(dem_vec);
    list[n].address = &w->engine->pairs.listed_at, list[n++].size = sizeof(dem_vec);
    list[n].address = &bodies->impact, list[n++].size = sizeof(dem_vec);
    list[n].address = &w->id, list[n++].size = sizeof(uint64_t);
    list[n].address = &bodies->bound, list[n++].size = sizeof(dem__bound);
    list[n].address = &bodies->sum, list[n++].size = sizeof(dem__sum);
    DEM__ADD_UP(w, n, list_arrays, (w, list + n));
    return n;
}

static inline int dem__may_postpone(const dem_world *w) { return w->engine->contacts.postponed || w->def.threads > 1; }

/* Lists the arrays of contacts, sorted by how long their values are needed: from step to step, ... */
static inline int dem__contact_arrays(dem_world *w, dem__array *list) {
    dem__contacts *contacts = &w->engine->contacts;
    int n = 0;
    int32_t **integers[] = {&contacts->i,    &contacts->j,         &contacts->element,
                            &contacts->near, &contacts->wall_next, &contacts->type};
    double **own[DEM__OWN_ARRAYS] = {&contacts->predict, &contacts->mass, &contacts->sum, &contacts->part};
    for (size_t k = 0; k < sizeof integers / sizeof *integers; k++, n++)
        list[n].address = integers[k], list[n].size = sizeof(int32_t);
    list[n].address = &contacts->gap, list[n++].size = sizeof(double);
    list[n].address = &contacts->force, list[n++].size = sizeof(double);
    for (int k = 0; k < contacts->states; k++, n++)
        list[n].address = &contacts->state[k], list[n].size = sizeof(double);
    for (int k = 0; w->engine->walls.touch_keepers && k < DEM__PLACES; k++, n++) {
        list[n].address = &contacts->touch[k], list[n].size = sizeof(double);
    }
    DEM__ADD_UP(w, n, list_contact_arrays, (w, list + n));
    list[n].address = &contacts->ended, list[n++].size = 1;
    /* ... with constants of their own, ... */
    for (int k = 0; k < DEM__OWN_ARRAYS; k++, n++) list[n].address = own[k], list[n].size = sizeof(double);
    for (int k = 0; k < contacts->constants; k++, n++)
        list[n].address = &contacts->constant[k], list[n].size = sizeof(double);
    /* ... after the last step of a run, ... */
    for (int k = 0; k < DEM__OUT_ARRAYS; k++, n++)
        list[n].address = &contacts->wrench[k], list[n].size = sizeof(double);
    /* ... within a step */
    list[n].address = &contacts->correction, list[n++].size = sizeof(dem__correction);
    list[n].address = &contacts->partial, list[n++].size = 1;
    list[n].address = &contacts->slots, list[n++].size = sizeof(int32_t);
    if (dem__may_postpone(w)) list[n].address = &contacts->postponed, list[n++].size = sizeof(dem__postponed);
    return n;
}

/* Lists the arrays of contacts, and returns how many of them, from the first, move with a contact to another slot. */
static inline int dem__kept_arrays(dem_world *w, dem__array *list) {
    const int with_out = dem__contact_arrays(w, list) - dem__may_postpone(w) - DEM__STEP_ARRAYS,
              with_own = with_out - DEM__OUT_ARRAYS;
    return w->engine->run.keeps_wrenches ? with_out
           : w->engine->contacts.type_count > DEM__TYPES_MAX
               ? with_own
               : with_own - DEM__OWN_ARRAYS - w->engine->contacts.constants;
}

/* Grows a group of arrays. All lie in one block, so that growing succeeds for all or changes nothing. Each begins with
   a cache line. Returns 0 when out of memory. */
static inline int dem__grow_group(dem_world *w, const dem__array *list, int n, void **block, size_t *bytes,
                                  ptrdiff_t *capacity, ptrdiff_t wanted) {
    ptrdiff_t larger =
        wanted > *capacity ? *capacity + *capacity / 2 + 64 : *capacity; /* additional arrays need no more entries */
    size_t total = 64;
    if (larger < wanted) larger = wanted;
    for (int k = 0; k < n; k++) {
        if ((size_t)larger > (SIZE_MAX / 4 - total) / list[k].size) return 0;
        total += ((size_t)larger * list[k].size + 63) & ~(size_t)63;
    }
    char *fresh = (char *)w->def.allocator.fn(w->def.allocator.user, NULL, 0, total), *at = fresh;
    if (!fresh) return 0;
    memset(fresh, 0, total);
    at += 64 - (size_t)((uintptr_t)fresh & 63);
    for (int k = 0; k < n; k++) {
        void *old = NULL, *now = at;
        memcpy(&old, list[k].address, sizeof old);
        if (old && *capacity > 0) memcpy(now, old, (size_t)*capacity * list[k].size);
        memcpy(list[k].address, &now, sizeof now);
        at += ((size_t)larger * list[k].size + 63) & ~(size_t)63;
    }
    if (*block) w->def.allocator.fn(w->def.allocator.user, *block, *bytes, 0);
    *block = fresh;
    *bytes = total;
    *capacity = larger;
    return 1;
}

/* Makes room for `count` timers, and for `bytes` beside each in another array. Returns 0 when out of memory. */
static inline int dem__grow_timers(dem_world *w, dem__timers *t, ptrdiff_t count, void *other, size_t bytes) {
    const dem__array list[] = {{&t->due, DEM__LINE * sizeof *t->due},
                               {&t->list, DEM__LINE * sizeof *t->list},
                               {&t->earliest, sizeof *t->earliest},
                               {other, DEM__LINE * bytes}};
    const ptrdiff_t lines = (count / DEM__PAGE + 1) * DEM__LINE;
    return lines <= t->capacity || dem__grow_group(w, list, 4, &t->block, &t->bytes, &t->capacity, lines);
}
static inline int dem__grow_near(dem_world *w, ptrdiff_t count) {
    dem__pairs *pairs = &w->engine->pairs;
    return dem__grow_timers(w, &pairs->timers, count, &pairs->near, sizeof *pairs->near);
}

/* Sets the number of timers, and stops those from `kept` on. */
static inline void dem__stop_timers(dem__timers *t, ptrdiff_t kept, ptrdiff_t count) {
    t->pages = count / DEM__PAGE + 1;
    for (ptrdiff_t e = kept; e < t->pages * DEM__PAGE; e++) t->due[e] = DEM__STOPPED;
    for (ptrdiff_t b = 0; b < t->pages * DEM__LINE; b++) {
        t->earliest[b] = DEM__STOPPED;
        for (const int32_t *due = t->due + b * DEM__LINE, *end = due + DEM__LINE; due < end; due++)
            t->earliest[b] = *due < t->earliest[b] ? *due : t->earliest[b];
    }
}

/* Makes timers count from another step. */
static inline void dem__count_from(dem__timers *t, int64_t step) {
    const int32_t later = (int32_t)(step - t->from);
    for (ptrdiff_t e = 0; e < t->pages * DEM__PAGE; e++) t->due[e] -= t->due[e] < DEM__NEVER ? later : 0;
    for (ptrdiff_t b = 0; b < t->pages * DEM__LINE; b++) t->earliest[b] -= t->earliest[b] < DEM__NEVER ? later : 0;
    t->from = step;
}

/* Makes room in a single array and loses its values. Returns 0 when out of memory. */
static inline int dem__grow_one(dem_world *w, int32_t **array, ptrdiff_t *capacity, ptrdiff_t wanted) {
    if (wanted <= *capacity) return 1;
    ptrdiff_t larger = wanted + wanted / 4 + 64;
    int32_t *fresh = (int32_t *)w->def.allocator.fn(w->def.allocator.user, NULL, 0, (size_t)larger * sizeof *fresh);
    if (!fresh) return 0;
    if (*array) w->def.allocator.fn(w->def.allocator.user, *array, (size_t)*capacity * sizeof **array, 0);
    *array = fresh;
    *capacity = larger;
    return 1;
}

/* Adds a feature to a world and makes room for its data of particles. DEM_BAD_ARGUMENT: another feature excludes it.
   After a failure nothing has changed. */
static inline dem_status dem__take_feature(dem_world *w, dem__feature feature) {
    dem__bodies *bodies = &w->engine->bodies;
    dem__array list[DEM__ARRAYS_MAX];
    for (int k = 0; k < w->engine->features; k++) {
        if (w->engine->feature[k].place == feature.place) return DEM_OK;
        if (w->engine->feature[k].exclusive && feature.exclusive)
            return dem__refuse(w, "world: a force field and links exclude each other");
    }
    dem__add_feature(w, feature);
    if (bodies->capacity == 0 || dem__grow_group(w, list, dem__particle_arrays(w, list), &bodies->block, &bodies->bytes,
                                                 &bodies->capacity, bodies->capacity))
        return DEM_OK;
    dem__drop_feature(w, feature.place);
    return DEM_OUT_OF_MEMORY;
}
