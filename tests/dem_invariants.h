/* dem_invariants.h: what must hold between two runs, whatever the scene: lists agree with their owners, every live contact has its bodies,
   no timer is late. The one file of the tests that reads private state of dem.h; it finds everything again by the slowest way. */
#ifndef RIDDLE_DEM_INVARIANTS_H
#define RIDDLE_DEM_INVARIANTS_H

#include "dem.h"

/* Slots are cut into sections one after the other, which hold as many contacts as there are. */
static inline const char *invariants__sections(const dem_world *w) {
    ptrdiff_t live = 0, end = 0;
    int32_t before = INT32_MAX;
    if (w->sections__ < 1 || w->sections__ > DEM__SECTIONS) return "number of sections";
    for (int q = 0; q < w->sections__; q++) {
        const dem__section *in = &w->section__[q];
        const int last = q == w->sections__ - 1;
        if (in->live < 0 || in->first < end || (!last && in->live > in->room)) return "a section overlaps another";
        if (in->from > before || (last && in->from != 0)) return "sections are not in the order of particles";
        for (ptrdiff_t c = in->first; c < in->first + in->live && !last; c++) {
            if (w->live_i__[c] < in->from || w->live_i__[c] >= before) return "a contact lies in another particle's section";
        }
        end = in->first + (last ? in->live : in->room);
        live += in->live;
        before = in->from;
    }
    if (live > 0 && end > w->live_capacity__) return "sections lie beyond the slots";
    return live == w->live_count__ ? NULL : "number of contacts";
}

/* Every contact has two bodies that are there, once, and each body counts its contacts. */
static inline const char *invariants__contacts(const dem_world *w, int32_t *count) {
    for (ptrdiff_t i = 0; i < w->count; i++) count[i] = 0;
    DEM__EACH(w, c) {
        const int32_t i = w->live_i__[c], j = w->live_j__[c];
        if (i < 0 || i >= w->count || !w->alive[i]) return "a contact of a particle that is gone";
        if (j >= 0 && (j >= w->count || !w->alive[j])) return "a contact with a particle that is gone";
        if (j >= 0 && j <= i) return "a contact whose first particle is not the lesser";
        if (j < -w->walls) return "a contact with a wall that is not there";
        if (w->live_ended__[c] && !w->stale__) return "a contact that has ended";
        count[i]++;
        if (j >= 0) count[j]++;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i] && w->touching[i] != count[i]) return "a particle counts its contacts wrongly";
    }
    for (ptrdiff_t i = 0; i < w->count && !w->stale__; i++) { /* of walls: in the list of the particle, each place once */
        int32_t with_walls = 0, at_walls = 0;
        for (int32_t c = w->wall_head__[i]; c >= 0; c = w->live_wall_next__[c]) {
            if (w->live_i__[c] != i || w->live_j__[c] >= 0) return "another's contact in a particle's list of walls";
            for (int32_t d = w->live_wall_next__[c]; d >= 0; d = w->live_wall_next__[d]) {
                if (w->live_j__[d] == w->live_j__[c] && w->live_element__[d] == w->live_element__[c]) return "one place touched twice";
            }
            if (++with_walls > w->live_count__) return "a particle's list of walls is a ring";
        }
        DEM__EACH(w, c) at_walls += w->live_i__[c] == i && w->live_j__[c] < 0;
        if (w->alive[i] && with_walls != at_walls) return "a particle's list of walls misses a contact";
    }
    return NULL;
}

/* Who touches something takes steps and is listed once. */
static inline const char *invariants__active(const dem_world *w, int32_t *seen) {
    ptrdiff_t dropped = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) seen[i] = 0;
    for (ptrdiff_t k = 0; k < w->active_count__; k++) {
        const int32_t i = w->active__[k];
        if (i < 0 || i >= w->count || seen[i]++) return "a particle stands twice among the active ones";
        if (!w->is_active__[i] && w->alive[i]) return "an inactive particle among the active ones";
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dropped += !w->alive[i];
        if (i > 0 && w->id[i] <= w->id[i - 1]) return "ids are not in order";
        if (w->particle[i].origin > w->step) return "a particle is ahead of its time";
        if (w->alive[i] && w->alive[i] != 1) return "a particle that is leaving between two steps";
        if (w->alive[i] && w->touching[i] > 0 && !seen[i]) return "a particle that touches takes no steps";
    }
    return dropped == w->dropped__ ? NULL : "number of dropped particles";
}

/* A link stands in the lists of its bodies, once. */
static inline const char *invariants__links(const dem_world *w) {
    ptrdiff_t listed = 0, sides = 0;
    for (ptrdiff_t k = 0; k < w->link_count__; k++) {
        const int32_t i = w->link_i__[k], j = w->link_j__[k];
        if (i < 0 || i >= w->count || !w->alive[i] || (j >= 0 && (j >= w->count || !w->alive[j])) || j < -w->walls)
            return "a link of a body that is gone";
        sides += j >= 0 ? 2 : 1;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        for (int32_t k = w->alive[i] ? w->link_head__[i] : -1; k >= 0; k = dem__next_link(w, k, i)) {
            if (k >= w->link_count__ || (w->link_i__[k] != i && w->link_j__[k] != i)) return "another's link in a particle's list";
            if (++listed > sides) return "a list of links is a ring";
        }
    }
    return listed == sides ? NULL : "a list of links misses one";
}

/* A bunch of timers is not asked later than one of its own. */
static inline const char *invariants__timers_of(const dem__timers *t, int64_t step) {
    for (ptrdiff_t e = 0; e < t->sheaves * DEM__SHEAF; e++) {
        if (t->due[e] >= DEM__NEVER) continue;
        if (t->earliest[e / DEM__BUNCH] > t->due[e]) return "a bunch of timers is asked too late";
        if (t->from + t->due[e] <= step) return "a timer has run out unseen";
    }
    return NULL;
}

/* A near pair stands in the lists of both particles; one that touches waits for nothing. */
static inline const char *invariants__pairs(const dem_world *w) {
    for (ptrdiff_t p = 0; p < w->near_count__; p++) {
        const dem__near *q = &w->near__[p];
        if (q->i < 0 || q->i >= q->j || q->j >= w->count) return "a near pair of no particles";
        for (int side = 0; side < 2; side++) {
            const int32_t of = side ? q->j : q->i, other = side ? q->i : q->j;
            int found = 0;
            for (int32_t a = w->adjacent_start__[of]; a < w->adjacent_start__[of + 1]; a++) {
                found += w->adjacent__[2 * a] == p && w->adjacent__[2 * a + 1] == other;
            }
            if (found != 1) return "a near pair is not in a particle's list";
        }
    }
    DEM__EACH(w, c) {
        const int32_t p = w->live_near__[c];
        if (w->live_j__[c] < 0 ? p != -1 : (p < 0 || p >= w->near_count__)) return "a contact without its near pair";
        if (p < 0) continue;
        if (w->near__[p].i != w->live_i__[c] || w->near__[p].j != w->live_j__[c]) return "a contact with another's near pair";
        if (w->pair_timers__.due[p] != DEM__STOPPED) return "a pair that touches has a timer";
    }
    return NULL;
}

static inline int invariants__touch(const dem_world *w, ptrdiff_t i, ptrdiff_t j) {
    DEM__EACH(w, c) {
        if (w->live_i__[c] == i && w->live_j__[c] == j) return 1;
    }
    return 0;
}

/* What overlaps is in contact, but for what first and last steps have shifted since it was looked at. */
static inline const char *invariants__overlaps(const dem_world *w) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const double shift = 2.0 * w->shifted__[i] + 4.0 * w->blur__;
        if (!w->alive[i]) continue;
        const dem_vec x = dem_position(w, i);
        for (ptrdiff_t j = i + 1; j < w->count; j++) {
            if (!w->alive[j]) continue;
            const double gap = dem__length(dem__apart(w, dem__sub(x, dem_position(w, j)))) - w->particle[i].radius - w->particle[j].radius;
            if (gap < -shift - 2.0 * w->shifted__[j] && !invariants__touch(w, i, j)) return "two particles overlap without a contact";
        }
        for (int k = 0; k < w->walls; k++) {
            dem__touch touch[DEM__TOUCHES];
            double least;
            const int n = w->wall[k].enabled ? dem__touch_wall(&w->wall[k], x, w->particle[i].radius, 0.0, touch, &least) : 0;
            if (w->wall[k].kind == DEM_EXIT) {
                if (least < -shift && w->wall[k].enabled && w->alive[i] > 0) return "a particle is beyond an exit";
                continue;
            }
            for (int q = 0; q < n; q++) {
                if (touch[q].gap < -shift && !invariants__touch(w, i, -1 - k)) return "a particle is in a wall without a contact";
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
    if (w->stale__ || w->fresh__) return broken; /* the lists are made when the next run begins */
    if (!broken) broken = invariants__pairs(w);
    if (!broken && (w->def.skip & DEM_SKIP_PAIRS)) broken = invariants__timers_of(&w->pair_timers__, w->step);
    if (!broken && (w->def.skip & DEM_SKIP_SPACE)) broken = invariants__timers_of(&w->wall_timers__, w->step);
    return broken ? broken : invariants__overlaps(w);
}

#endif
