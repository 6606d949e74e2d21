/* Near pairs and the rebuilding of their list: the broad phase. Reads bodies; writes pairs, timers and bounds.
   Promises: two spheres that are not listed cannot touch before the next check. */
#pragma once
#include "narrow_phase.h"
#include "../particles/active.h"
#include "cells.h"
#include "skin.h"

/* The near pairs that a thread finds; room: how many fit. */
typedef struct dem__found_pairs {
    dem__near *pair;
    ptrdiff_t n, room;
    int full;
} dem__found_pairs;

static inline int dem__add_near(const dem_world *w, dem__found_pairs *finds, int32_t i, int32_t j) {
    if (finds->n == finds->room) return 0;
    dem__near *q = &finds->pair[finds->n++];
    const int in_order = w->id[i] < w->id[j]; /* the order of their ids, whatever their order in memory */
    q->i = in_order ? i : j;
    q->j = in_order ? j : i;
    q->distance = w->particle[i].radius + w->particle[j].radius;
    return 1;
}

/* Spheres that may be near those of a cell. */
enum {
    DEM__CANDIDATES_MAX = 256
}; /* twice as many as a cell and its neighbours hold in a dense bed of equal spheres */
typedef struct dem__candidates {
    double x[DEM__CANDIDATES_MAX], y[DEM__CANDIDATES_MAX], z[DEM__CANDIDATES_MAX], extent[DEM__CANDIDATES_MAX];
    int32_t at[DEM__CANDIDATES_MAX]; /* in the sorted list */
    int n;
} dem__candidates;

/* Returns a difference of coordinates within the periodic box for the nearest image. */
DEM_INLINE double dem__image(double d, double length) {
    d = d > 0.5 * length ? d - length : d;
    return d < -0.5 * length ? d + length : d;
}

/* Lists the candidates near a sphere. Has no branch, because it would be mispredicted. */
DEM_INLINE void dem__choose_near(const dem__candidates *c, const dem__bound *s, const double *length, int32_t *near,
                                 int *count) {
    double room[DEM__CANDIDATES_MAX];
    int m = 0;
    for (int k = 0; k < c->n; k++) {
        double x = s->x - c->x[k], y = s->y - c->y[k], z = s->z - c->z[k];
        if (length) x = dem__image(x, length[0]), y = dem__image(y, length[1]), z = dem__image(z, length[2]);
        const double sum = s->tolerance + c->extent[k];
        room[k] = x * x + y * y + z * z - sum * sum;
    }
    for (int k = 0; k < c->n; k++) {
        near[m] = k;
        m += room[k] < 0.0;
    }
    *count = m;
}
DEM__AVX2_CLONE(dem__choose,
                (const dem__candidates *c, const dem__bound *s, const double *length, int32_t *near, int *count),
                (c, s, length, near, count), dem__choose_near(c, s, length, near, count))

/* Adds the near pairs of spheres first .. end-1 of the sorted list, each with the candidates that follow it in the
   list. Returns 0 if they do not fit. */
static inline int dem__pairs_with_candidates(const dem_world *w, const dem__candidates *crowd, int32_t first,
                                             int32_t end, dem__found_pairs *finds) {
    const double length[3] = {dem__period(w, 0), dem__period(w, 1), dem__period(w, 2)};
    int32_t near[DEM__CANDIDATES_MAX];
    for (int32_t p = first; p < end; p++) {
        int n;
        dem__choose(crowd, &w->engine->bodies.bound[p], w->engine->run.has_periodic ? length : NULL, near, &n);
        for (int k = 0; k < n; k++) {
            const int32_t q = crowd->at[near[k]];
            if (q > p && !dem__add_near(w, finds, w->engine->scratch.index[p], w->engine->scratch.index[q])) return 0;
        }
    }
    return 1;
}

/* Adds the near pairs of spheres first .. end-1 of the sorted list, which share a cell, with the spheres that follow
   each of them on one level. Returns 0 if they do not fit. */
static inline int dem__find_pairs_of(const dem_world *w, const dem__grid *g, int32_t first, int32_t end,
                                     dem__found_pairs *finds) {
    const int32_t *start = w->engine->pairs.cells;
    const dem__bound *scratch = w->engine->bodies.bound;
    dem_vec low = dem_vec3(scratch[first].x, scratch[first].y, scratch[first].z), high = low;
    double extent = 0.0;
    dem__candidates crowd;
    for (int32_t p = first; p < end; p++) {
        low.x = scratch[p].x < low.x ? scratch[p].x : low.x, high.x = scratch[p].x > high.x ? scratch[p].x : high.x;
        low.y = scratch[p].y < low.y ? scratch[p].y : low.y, high.y = scratch[p].y > high.y ? scratch[p].y : high.y;
        low.z = scratch[p].z < low.z ? scratch[p].z : low.z, high.z = scratch[p].z > high.z ? scratch[p].z : high.z;
        extent = scratch[p].tolerance > extent ? scratch[p].tolerance : extent;
    }
    const double reach = extent + g->widest + 0.5 * w->engine->pairs.skin;
    int32_t from[3], cells[3];
    for (int a = 0; a < 3; a++) {
        const double l = dem_axis(low, a), h = dem_axis(high, a);
        cells[a] = dem__cells(g, a, 0.5 * (l + h), 0.5 * (h - l) + reach, &from[a]);
    }
    const int32_t before =
        cells[0] < g->n[0] - from[0] ? cells[0] : g->n[0] - from[0]; /* cells of a row before it wraps */
    crowd.n = 0;
    for (int32_t row = 0; row < cells[1] * cells[2]; row++) {
        const int32_t cy = from[1] + row % cells[1], cz = from[2] + row / cells[1];
        const int32_t iy = cy < g->n[1] ? cy : cy - g->n[1], iz = cz < g->n[2] ? cz : cz - g->n[2];
        const int32_t *cell = start + g->first + ((ptrdiff_t)iz * g->n[1] + iy) * g->n[0];
        for (int part = 0; part < 2; part++) { /* cells that are neighbours in a row are neighbours in the list */
            const int32_t last = part ? cell[cells[0] - before] : cell[from[0] + before];
            int32_t q = part ? cell[0] : cell[from[0]];
            for (q = q > first ? q : first; q < last; q++) {
                if (crowd.n == DEM__CANDIDATES_MAX) {
                    if (!dem__pairs_with_candidates(w, &crowd, first, end, finds)) return 0;
                    crowd.n = 0;
                }
                crowd.x[crowd.n] = scratch[q].x, crowd.y[crowd.n] = scratch[q].y, crowd.z[crowd.n] = scratch[q].z;
                crowd.extent[crowd.n] = scratch[q].tolerance;
                crowd.at[crowd.n++] = q;
            }
        }
    }
    return dem__pairs_with_candidates(w, &crowd, first, end, finds);
}

/* Sorts the spheres by size class, then by the cells of the class's grid. Returns the number of classes; 0 when out of
   memory. Uses the bounds as scratch memory, because a rebuild sets all of them. */
static inline int dem__fill_cells(dem_world *w, dem__grid *grid) {
    dem__bodies *bodies = &w->engine->bodies;
    dem__pairs *pairs = &w->engine->pairs;
    double smallest = HUGE_VAL;
    dem_vec low, high;
    int32_t *sorted = w->engine->scratch.index;
    ptrdiff_t cells = 0;
    int levels = 0;
    for (ptrdiff_t i = 0; i < w->count; i++)
        smallest = w->particle[i].radius < smallest ? w->particle[i].radius : smallest;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const double r = w->particle[i].radius;
        const int level = dem__level(r, smallest);
        if (!w->alive[i]) continue;
        grid[level].widest = r > grid[level].widest ? r : grid[level].widest;
        grid[level].count++;
        sorted[i] = level;
    }
    for (int a = 0; a < 3; a++)
        dem__bulk(w->engine->pairs.listed_at, a, w->count, dem_axis_of(&low, a), dem_axis_of(&high, a));
    for (int level = 0; level < DEM__LEVELS_MAX; level++) {
        dem__grid *g = &grid[level];
        if (g->count == 0) continue;
        levels = level + 1;
        dem__make_grid(w, g, 2.0 * g->widest + pairs->skin, low, high);
        g->first = cells;
        cells += (ptrdiff_t)g->n[0] * g->n[1] * g->n[2];
    }
    if (!dem__grow_one(w, &pairs->cells, &pairs->cells_capacity, cells + 1)) return 0;
    int32_t *start = pairs->cells;
    for (ptrdiff_t c = 0; c <= cells; c++) start[c] = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        const ptrdiff_t c = dem__cell(&grid[sorted[i]], w->engine->pairs.listed_at[i]);
        pairs->cell_of[i] = (int32_t)c;
        start[c]++;
    }
    for (ptrdiff_t c = 0, sum = 0; c <= cells; c++) {
        sum += start[c];
        start[c] = (int32_t)sum;
    }
    for (ptrdiff_t i = w->count - 1; i >= 0; i--) {
        if (!w->alive[i]) continue;
        const int32_t k = --start[pairs->cell_of[i]];
        sorted[k] = (int32_t)i;
        bodies->bound[k].x = w->engine->pairs.listed_at[i].x, bodies->bound[k].y = w->engine->pairs.listed_at[i].y,
        bodies->bound[k].z = w->engine->pairs.listed_at[i].z;
        bodies->bound[k].tolerance = w->particle[i].radius + 0.5 * pairs->skin;
    }
    return levels;
}

/* Finds the near pairs of the spheres whose cells begin in first .. end-1 of the sorted list. The spheres of a cell are
   compared with those in the cells around it, on their own level and on coarser ones, if these follow them in the list.
   Returns 0 if the pairs do not fit. */
static inline int dem__find_pairs_part(const dem_world *w, const dem__grid *grid, int levels, ptrdiff_t first,
                                       ptrdiff_t end, dem__found_pairs *finds) {
    const int32_t *start = w->engine->pairs.cells;
    ptrdiff_t of_level = 0, p = first;
    finds->n = 0;
    for (int level = 0; level < levels; level++) {
        for (of_level += grid[level].count; p < of_level && p < end;) {
            const int32_t cell = w->engine->pairs.cell_of[w->engine->scratch.index[p]], from = start[cell],
                          to = start[cell + 1];
            for (int other = level; other < levels && from == p; other++) {
                if (grid[other].count > 0 && !dem__find_pairs_of(w, &grid[other], from, to, finds)) return 0;
            }
            p = to;
        }
    }
    return 1;
}

/* A search for near pairs by several threads, each with its part of the array. */
typedef struct dem__search {
    dem__grid grid[DEM__LEVELS_MAX];
    dem__found_pairs finds[DEM__PARTS_MAX];
    int levels, parts;
    ptrdiff_t room;
} dem__search;
static inline void dem__search_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    dem__search *s = (dem__search *)context;
    const ptrdiff_t from = dem__part(s->room, part, s->parts);
    s->finds[part].pair = w->engine->pairs.near + from;
    s->finds[part].room = dem__part(s->room, part + 1, s->parts) - from;
    s->finds[part].full = !dem__find_pairs_part(w, s->grid, s->levels, first, end, &s->finds[part]);
}

/* Removes pairs within a rigid body, and pairs of two fixed particles. */
static inline void dem__drop_skipped_pairs(dem_world *w) {
    dem__pairs *pairs = &w->engine->pairs;
    ptrdiff_t kept = 0;
    for (ptrdiff_t p = 0; p < pairs->count; p++) {
        const dem__near q = pairs->near[p];
        pairs->near[kept] = q;
        kept += !dem__cannot_meet(w, q.i, q.j);
    }
    pairs->count = kept;
}

/* Finds the near pairs: those with a gap below the skin. Each thread searches a part of the sorted spheres. If one runs
   out of room, all search again with more. Returns 0 when out of memory. */
static inline int dem__find_pairs(dem_world *w) {
    dem__pairs *pairs = &w->engine->pairs;
    dem__search s;
    ptrdiff_t present = 0;
    int full = 1;
    pairs->count = 0;
    if (w->count == 0) return 1;
    memset(s.grid, 0, sizeof s.grid);
    s.room = w->count < INT32_MAX / 24 ? 6 * w->count : INT32_MAX / 4;
    s.levels = dem__fill_cells(w, s.grid), s.parts = dem__parts(w, w->count);
    for (int level = 0; level < s.levels; level++) present += s.grid[level].count;
    while (full) {
        if (s.levels == 0 || s.room > INT32_MAX / 2 || !dem__grow_near(w, s.room)) return 0;
        s.room = pairs->timers.capacity * DEM__LINE;
        full = 0;
        dem__in_parts(w, s.parts, present, dem__search_range, &s);
        for (int q = 0; q < s.parts; q++) full |= s.finds[q].full;
        s.room++;
    }
    for (int q = 0; q < s.parts; q++) {
        memmove(pairs->near + pairs->count, s.finds[q].pair, (size_t)s.finds[q].n * sizeof *pairs->near);
        pairs->count += s.finds[q].n;
    }
    if (w->engine->bodies.rigid || w->engine->bodies.has_fixed) dem__drop_skipped_pairs(w);
    return 1;
}

/* Lists the near pairs of each particle; each pair is listed twice. Returns 0 when out of memory. */
static inline int dem__find_adjacent(dem_world *w) {
    dem__pairs *pairs = &w->engine->pairs;
    if (w->count == 0) return 1;
    if (!dem__grow_one(w, &pairs->adjacent, &pairs->adjacent_capacity, 4 * pairs->count)) return 0;
    int32_t *start = pairs->adjacent_start;
    for (ptrdiff_t i = 0; i <= w->count; i++) start[i] = 0;
    for (ptrdiff_t p = 0; p < pairs->count; p++) start[pairs->near[p].i]++, start[pairs->near[p].j]++;
    for (ptrdiff_t i = 0, sum = 0; i <= w->count; i++) {
        sum += start[i];
        start[i] = (int32_t)sum;
    }
    for (ptrdiff_t p = pairs->count - 1; p >= 0; p--) {
        const int32_t i = pairs->near[p].i, j = pairs->near[p].j, a = --start[i], b = --start[j];
        pairs->adjacent[2 * a] = pairs->adjacent[2 * b] = (int32_t)p;
        pairs->adjacent[2 * a + 1] = j, pairs->adjacent[2 * b + 1] = i;
    }
    return 1;
}

static inline void dem__list_wall_contacts(dem_world *w) {
    dem__wall_state *walls = &w->engine->walls;
    dem__contacts *contacts = &w->engine->contacts;
    for (ptrdiff_t i = 0; i < w->count; i++) walls->first_contact[i] = -1;
    DEM__EACH_CONTACT(w, c) {
        if (contacts->j[c] >= 0) continue;
        contacts->wall_next[c] = walls->first_contact[contacts->i[c]];
        walls->first_contact[contacts->i[c]] = (int32_t)c;
    }
}

/* Finds the near pair of each contact and stops its timer. */
static inline void dem__find_contacts(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    DEM__EACH_CONTACT(w, c) {
        if (dem__is_convex_contact(w, c)) continue; /* dem__list_convex_pairs does it */
        const int32_t p = contacts->j[c] < 0 ? -1 : dem__near_pair(w, contacts->i[c], contacts->j[c]);
        contacts->near[c] = p;
        if (p >= 0) dem__stop_timer(&w->engine->pairs.timers, p);
    }
}

/* Sets the timers of all near pairs in pages first .. end-1 that do not touch. */
DEM_INLINE void dem__set_new_timers(dem_world *w, ptrdiff_t first, ptrdiff_t end) {
    const dem__pairs *pairs = &w->engine->pairs;
    const double t = dem__since_listed(w, w->step);
    dem__timer_batch waits;
    dem__clear_batch(&waits);
    for (ptrdiff_t p = first * DEM__PAGE; p < end * DEM__PAGE; p++) {
        if (pairs->timers.due[p] == DEM__STOPPED) continue;
        const dem__bound a = dem__bound_at(&w->engine->bodies.bound[pairs->near[p].i], t),
                         b = dem__bound_at(&w->engine->bodies.bound[pairs->near[p].j], t);
        dem__batch_bounds(w, &waits, (int32_t)p, w->step, &a, &b);
    }
    dem__flush_batch(w, &waits, w->step);
}
DEM__AVX2_CLONE(dem__set_new_timers_part, (dem_world * w, ptrdiff_t first, ptrdiff_t end), (w, first, end),
                dem__set_new_timers(w, first, end))
static inline void dem__set_new_timers_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    (void)part, (void)context;
    dem__set_new_timers_part(w, first, end);
}
static inline void dem__set_all_timers(dem_world *w) {
    const dem__pairs *pairs = &w->engine->pairs;
    if (w->def.skip & DEM_SKIP_PAIRS)
        dem__in_parts(w, dem__parts(w, pairs->count), pairs->timers.pages, dem__set_new_timers_range, NULL);
}

/* Makes the timers of a new list. Near pairs begin without contact. Wall timers stay (keeps), or all are stopped.
   Returns 0 when out of memory. */
static inline int dem__make_timers(dem_world *w, int keeps) {
    dem__pairs *pairs = &w->engine->pairs;
    const ptrdiff_t walls = w->count * w->walls;
    dem__timers *pair = &pairs->timers, *wall = &w->engine->walls.timers;
    if (!dem__grow_near(w, pairs->count)) return 0;
    for (ptrdiff_t p = 0; p < pairs->count; p++) pair->due[p] = DEM__NEVER;
    dem__stop_timers(pair, pairs->count, pairs->count);
    pair->from = w->step;
    if (!keeps) {
        if (!dem__grow_timers(w, wall, walls, &w->engine->walls.sure, sizeof *w->engine->walls.sure)) return 0;
        dem__stop_timers(wall, 0, walls);
        wall->from = w->step;
    } else dem__count_from(wall, w->step);
    return 1;
}

/* Lowers the speed limits of driven walls where possible, and sets the wall timers for a new list. */
static inline void dem__set_wall_timers(dem_world *w, int keeps) {
    for (int k = 0; k < w->walls; k++) {
        dem_wall *a = &w->wall[k];
        const double speed = 1.5 * dem__length(a->velocity), spin = 1.5 * fabs(a->spin);
        if (a->asked.drive == DEM_KINEMATIC || (speed > 0.5 * a->speed_bound && spin >= 0.5 * a->spin_bound)) continue;
        a->speed_bound = speed, a->spin_bound = spin;
        if (keeps) dem__test_wall_by_all(w, k, w->step + 1);
    }
    for (ptrdiff_t i = 0; i < w->count && !keeps && (w->def.skip & DEM_SKIP_SPACE); i++) {
        for (int k = 0; k < w->walls; k++) {
            if (dem__needs_test(w, i, k))
                dem__set_timer(&w->engine->walls.timers, (int32_t)i * w->walls + k, w->step + 1);
        }
    }
}

/* Records a failure while lists are built: the next run builds all of them again. Returns 0. */
static inline int dem__fail_to_list(dem_world *w, dem_status status) {
    w->status = status;
    w->engine->run.needs_lists = 1;
    return 0;
}

/* Rebuilds near pairs, timers and bounds. Wall timers stay unless the caller changed something. Returns 0 after a
   failure. */
static DEM__NOINLINE int dem__rebuild(dem_world *w) {
    dem__run *run = &w->engine->run;
    dem__bodies *bodies = &w->engine->bodies;
    dem__pairs *pairs = &w->engine->pairs;
    const int keeps = !run->needs_lists;
    DEM__TELL(w, keep_up, (w));
    if (w->status != DEM_OK) return 0;
    /* closing the gaps costs about as much as finding the pairs */
    if (!keeps || bodies->dropped > w->count / 16) dem__compact(w);
    if (!keeps) dem__release_unloaded(w);
    dem__list_active(w);
    dem_status status = DEM_OK;
    double smallest, largest;
    if (!dem__list_positions(w, &smallest, &largest)) return 0;
    dem__choose_frame(w);
    dem__choose_skin(w, keeps, smallest, largest);
    if (!dem__find_pairs(w) || !dem__find_adjacent(w)) return dem__fail_to_list(w, DEM_OUT_OF_MEMORY);
    if (pairs->count > INT32_MAX / 4 || w->count * w->walls > INT32_MAX / 2) return dem__fail_to_list(w, DEM_TOO_MANY);
    if (!dem__make_timers(w, keeps)) return dem__fail_to_list(w, DEM_OUT_OF_MEMORY);
    run->needs_lists = 0;
    dem__list_wall_contacts(w);
    dem__find_contacts(w);
    DEM__CHECK(w, status, listed, (w));
    if (status != DEM_OK) return dem__fail_to_list(w, status);
    pairs->next_check = w->step + DEM__STEPS_MAX;
    pairs->listed_step = w->step;
    w->rebuilds++;
    for (ptrdiff_t i = 0; i < w->count && !keeps; i++) bodies->wall_speed[i] = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i]) dem__renew_bound(w, i, w->step);
    }
    if (pairs->next_check <= w->step) pairs->next_check = w->step + 1; /* the skin is large enough for one step */
    dem__set_all_timers(w);
    if (w->status != DEM_OK) return 0;
    dem__set_wall_timers(w, keeps);
    return 1;
}

/* Checks whether anything has moved so far that an unlisted pair could touch soon. If so, rebuilds the list; otherwise
   sets the step of the next check. A rebuild takes as long as forty checks, so the older the list, the more steps a
   check must gain. Returns 0 after a failure. */
static DEM__NOINLINE int dem__check_list(dem_world *w) {
    const dem__list_frame frame = dem__frame_at(w, w->step);
    const int64_t least = 1 + (w->step - w->engine->pairs.listed_step) / 40;
    DEM__TELL(w, keep_up, (w));
    int64_t due = w->engine->pairs.listed_step + DEM__STEPS_MAX;
    if (w->step >= due) return dem__rebuild(w);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        const double tau = dem__now(w, i);
        const dem__skin_left skin = dem__skin_left_of(w, i, &frame, dem__at(w, i, tau), dem__velocity_at(w, i, tau));
        if (dem__lasts(w, &skin, (double)(due - w->step) * w->engine->run.dt)) continue;
        const int steps = dem__steps_left(w, &skin);
        if (steps < least) return dem__rebuild(w);
        due = w->step + steps;
    }
    w->engine->pairs.next_check = due;
    return 1;
}
