/* dem_invariants.h: what must hold between two runs, whatever the scene: lists agree with their owners, every live
   contact has its bodies, no timer is late. The one file of the tests that reads private state of dem.h; it finds
   everything again by the slowest way. */
#ifndef RIDDLE_DEM_INVARIANTS_H
#define RIDDLE_DEM_INVARIANTS_H

#include "dem.h"

/* Slots are cut into chunks one after the other, which hold as many contacts as there are. */
static inline const char *invariants__sections(const dem_world *w) {
    ptrdiff_t live = 0, end = 0;
    int32_t before = INT32_MAX;
    if (w->engine->contacts.chunk_count < 1 || w->engine->contacts.chunk_count > DEM__CHUNKS) return "number of chunks";
    for (int q = 0; q < w->engine->contacts.chunk_count; q++) {
        const dem__chunk *in = &w->engine->contacts.chunk[q];
        const int last = q == w->engine->contacts.chunk_count - 1;
        if (in->count < 0 || in->first < end || (!last && in->count > in->capacity)) return "a chunk overlaps another";
        if (in->first_rank > before || (last && in->first_rank != 0)) return "chunks are not in the order of ranks";
        for (ptrdiff_t c = in->first; c < in->first + in->count && !last; c++) {
            const int32_t low = dem__rank_in_slot(w, c);
            if (low < in->first_rank || low >= before)
                return "a contact lies in another particle's chunk";
        }
        end = in->first + (last ? in->count : in->capacity);
        live += in->count;
        before = in->first_rank;
    }
    if (live > 0 && end > w->engine->contacts.capacity) return "chunks lie beyond the slots";
    return live == w->engine->contacts.count ? NULL : "number of contacts";
}

/* Every contact has two bodies that are there, once, and each body counts its contacts. */
static inline const char *invariants__contacts(const dem_world *w, int32_t *count) {
    for (ptrdiff_t i = 0; i < w->count; i++) count[i] = 0;
    DEM__EACH_CONTACT(w, c) {
        const int32_t i = w->engine->contacts.i[c], j = w->engine->contacts.j[c];
        if (i < 0 || i >= w->count || !w->alive[i]) return "a contact of a particle that is gone";
        if (j >= 0 && (j >= w->count || !w->alive[j])) return "a contact with a particle that is gone";
        if (j >= 0 && j <= i) return "a contact whose first particle is not the lesser";
        if (j < -w->walls) return "a contact with a wall that is not there";
        if (w->engine->contacts.ended[c] && !w->engine->run.needs_lists) return "a contact that has ended";
        count[i]++;
        if (j >= 0) count[j]++;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i] && w->touching[i] != count[i]) return "a particle counts its contacts wrongly";
    }
    /* of walls: in the list of the particle, each place once */
    for (ptrdiff_t i = 0; i < w->count && !w->engine->run.needs_lists; i++) {
        int32_t with_walls = 0, at_walls = 0;
        for (int32_t c = w->engine->walls.first_contact[i]; c >= 0; c = w->engine->contacts.wall_next[c]) {
            if (w->engine->contacts.i[c] != i || w->engine->contacts.j[c] >= 0)
                return "another's contact in a particle's list of walls";
            for (int32_t d = w->engine->contacts.wall_next[c]; d >= 0; d = w->engine->contacts.wall_next[d]) {
                if (w->engine->contacts.j[d] == w->engine->contacts.j[c] &&
                    w->engine->contacts.element[d] == w->engine->contacts.element[c])
                    return "one place touched twice";
            }
            if (++with_walls > w->engine->contacts.count) return "a particle's list of walls is a ring";
        }
        DEM__EACH_CONTACT(w, c) at_walls += w->engine->contacts.i[c] == i && w->engine->contacts.j[c] < 0;
        if (w->alive[i] && with_walls != at_walls) return "a particle's list of walls misses a contact";
    }
    return NULL;
}

/* Who touches something takes steps and is listed once. */
static inline const char *invariants__active(const dem_world *w, int32_t *seen) {
    ptrdiff_t dropped = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) seen[i] = 0;
    for (ptrdiff_t k = 0; k < w->engine->bodies.active_count; k++) {
        const int32_t i = w->engine->bodies.active[k];
        if (i < 0 || i >= w->count || seen[i]++) return "a particle stands twice among the active ones";
        if (!w->engine->bodies.activity[i] && w->alive[i]) return "an inactive particle among the active ones";
        if (w->engine->bodies.active_at[i] != k) return "an active particle does not know its place";
    }
    for (ptrdiff_t r = 0; r < w->count; r++) {
        const int32_t i = w->engine->bodies.by_rank[r];
        if (i < 0 || i >= w->count || w->engine->bodies.rank[i] != r) return "ranks are no order";
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->engine->bodies.number[i] != i - dropped) return "the particles present are not numbered";
        dropped += !w->alive[i];
        if (i > 0 && w->id[i] <= w->id[i - 1]) return "ids are not in order";
        if (w->particle[i].origin > w->step) return "a particle is ahead of its time";
        if (w->alive[i] && w->alive[i] != 1) return "a particle that is leaving between two steps";
        if (w->alive[i] && w->touching[i] > 0 && !seen[i]) return "a particle that touches takes no steps";
    }
    return dropped == w->engine->bodies.dropped ? NULL : "number of dropped particles";
}

/* A link stands in the lists of its bodies, once. */
static inline const char *invariants__links(const dem_world *w) {
    ptrdiff_t listed = 0, sides = 0;
    for (ptrdiff_t k = 0; k < w->engine->links.count; k++) {
        const int32_t i = w->engine->links.i[k], j = w->engine->links.j[k];
        if (i < 0 || i >= w->count || !w->alive[i] || (j >= 0 && (j >= w->count || !w->alive[j])) || j < -w->walls)
            return "a link of a body that is gone";
        sides += j >= 0 ? 2 : 1;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        for (int32_t k = w->engine->links.on && w->alive[i] ? w->engine->links.first_link[i] : -1; k >= 0;
             k = dem__next_link(w, k, i)) {
            if (k >= w->engine->links.count || (w->engine->links.i[k] != i && w->engine->links.j[k] != i))
                return "another's link in a particle's list";
            if (++listed > sides) return "a list of links is a ring";
        }
    }
    return listed == sides ? NULL : "a list of links misses one";
}

/* A line of timers is not asked later than one of its own. */
static inline const char *invariants__timers_of(const dem__timers *t, int64_t step) {
    for (ptrdiff_t e = 0; e < t->pages * DEM__PAGE; e++) {
        if (t->due[e] >= DEM__NEVER) continue;
        if (t->earliest[e / DEM__LINE] > t->due[e]) return "a line of timers is asked too late";
        if (t->from + t->due[e] <= step) return "a timer has run out unseen";
    }
    return NULL;
}

/* A near pair stands in the lists of both particles; one that touches waits for nothing. */
static inline const char *invariants__pairs(const dem_world *w) {
    for (ptrdiff_t p = 0; p < w->engine->pairs.count; p++) {
        const dem__near *q = &w->engine->pairs.near[p];
        if (q->i < 0 || q->i >= q->j || q->j >= w->count) return "a near pair of no particles";
        for (int side = 0; side < 2; side++) {
            const int32_t of = side ? q->j : q->i, other = side ? q->i : q->j;
            int found = 0;
            for (int32_t a = w->engine->pairs.adjacent_start[of]; a < w->engine->pairs.adjacent_start[of + 1]; a++) {
                found += w->engine->pairs.adjacent[2 * a] == p && w->engine->pairs.adjacent[2 * a + 1] == other;
            }
            if (found != 1) return "a near pair is not in a particle's list";
        }
    }
    DEM__EACH_CONTACT(w, c) {
        const int32_t p = w->engine->contacts.near[c];
        if (w->engine->contacts.j[c] < 0 ? p != -1 : (p < 0 || p >= w->engine->pairs.count))
            return "a contact without its near pair";
        if (p < 0) continue;
        if (w->engine->pairs.near[p].i != w->engine->contacts.i[c] ||
            w->engine->pairs.near[p].j != w->engine->contacts.j[c])
            return "a contact with another's near pair";
        if (w->engine->pairs.timers.due[p] != DEM__STOPPED) return "a pair that touches has a timer";
    }
    return NULL;
}

static inline int invariants__touch(const dem_world *w, ptrdiff_t i, ptrdiff_t j) {
    DEM__EACH_CONTACT(w, c) {
        if (w->engine->contacts.i[c] == i && w->engine->contacts.j[c] == j) return 1;
    }
    return 0;
}

/* What overlaps is in contact, but for what first and last steps have shifted since it was looked at. */
static inline const char *invariants__overlaps(const dem_world *w) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const double shift = 2.0 * w->engine->bodies.shifted[i] + 4.0 * w->engine->pairs.position_tolerance;
        if (!w->alive[i]) continue;
        const dem_vec x = dem_position(w, i);
        for (ptrdiff_t j = i + 1; j < w->count; j++) {
            if (!w->alive[j]) continue;
            const double gap = dem__length(dem__nearest_image(w, dem__sub(x, dem_position(w, j)))) - dem_radius(w, i) -
                               dem_radius(w, j);
            if (gap < -shift - 2.0 * w->engine->bodies.shifted[j] && !invariants__touch(w, i, j))
                return "two particles overlap without a contact";
        }
        for (int k = 0; k < w->walls; k++) {
            dem__touch touch[DEM__TOUCHES];
            double least;
            const int n =
                w->wall[k].enabled ? dem__touch_wall(&w->wall[k], x, dem_radius(w, i), 0.0, touch, &least) : 0;
            if (w->wall[k].kind == DEM_EXIT) {
                if (least < -shift && w->wall[k].enabled && w->alive[i] > 0) return "a particle is beyond an exit";
                continue;
            }
            for (int q = 0; q < n; q++) {
                if (touch[q].gap < -shift && !invariants__touch(w, i, -1 - k))
                    return "a particle is in a wall without a contact";
            }
        }
    }
    return NULL;
}

/* NULL, or what is broken. scratch: room for w->count numbers. A world that has failed owes nothing. */
static inline const char *dem_broken_invariant(const dem_world *w, int32_t *scratch) {
    if (w->status != DEM_OK) return NULL;
    const char *broken = invariants__sections(w);
    if (!broken) broken = invariants__contacts(w, scratch);
    if (!broken) broken = invariants__active(w, scratch);
    if (!broken) broken = invariants__links(w);
    /* the lists are made when the next run begins */
    if (w->engine->run.needs_lists || w->engine->run.needs_forces) return broken;
    if (!broken) broken = invariants__pairs(w);
    if (!broken && (w->def.skip & DEM_SKIP_PAIRS)) broken = invariants__timers_of(&w->engine->pairs.timers, w->step);
    if (!broken && (w->def.skip & DEM_SKIP_SPACE)) broken = invariants__timers_of(&w->engine->walls.timers, w->step);
    return broken ? broken : invariants__overlaps(w);
}

#endif
