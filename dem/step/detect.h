/* Tests of the pairs and walls that are due. Reads timers, bodies, walls; writes new contacts and timers. Promises:
   every contact that begins is found, and a step that cannot be finished leaves no trace. */
#pragma once
#include "../contacts/contacts.h"

/* Sets the status, and failed_id to the first particle whose state is not finite. Returns 0. */
static inline int dem__fail(dem_world *w, dem_status status) {
    int failed = 0;
    w->status = status;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_particle *p = &w->particle[i];
        const dem_vec sum = dem__add(dem__add(p->v, p->a), dem__add(p->spin, w->spin_rate[i]));
        const double v = sum.x + sum.y + sum.z;
        if (fabs(v) <= DBL_MAX || (failed && w->failed_id < w->id[i])) continue;
        failed = 1, w->failed_id = w->id[i];
    }
    return 0;
}

/* Tests the due pairs in pages first .. end-1. */
DEM_INLINE void dem__test_due_part(dem_world *w, dem__timer_batch *waits, ptrdiff_t first, ptrdiff_t end, int64_t step,
                                   int rigid) {
    dem__pairs *pairs = &w->engine->pairs;
    int32_t *due = pairs->timers.list + first * DEM__PAGE;
    ptrdiff_t n;
    dem__list_due(&pairs->timers, first, end, step, DEM__NEVER, &n);
    dem__clear_batch(waits);
    waits->found = due; /* the list of pairs found overwrites pairs that have been tested */
    for (ptrdiff_t k = dem__prefetch_from(n, 2 * DEM__AHEAD); k < n; k++) {
        const ptrdiff_t flight = k + DEM__AHEAD, pair = flight + DEM__AHEAD;
        if (pair < n) DEM__PREFETCH(&pairs->near[due[pair]]);
        if (flight >= 0 && flight < n) {
            dem__prefetch_flight(w, pairs->near[due[flight]].i);
            dem__prefetch_flight(w, pairs->near[due[flight]].j);
        }
        if (k >= 0) dem__test_pair(w, waits, due[k], step, rigid);
    }
    dem__flush_batch(w, waits, step);
}

static inline void dem__test_due_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *step) {
    dem__test_due_part(w, &dem__work_of(w, part)->batch, first, end, *(const int64_t *)step, 0);
}

/* What the tests of a group of pages have found. Threads take groups in turn, because due pairs lie close together. */
typedef struct dem__tested {
    int32_t *found;
    ptrdiff_t touch;
    int64_t looks;
} dem__tested;
typedef struct dem__due_tests {
    dem__tested of[DEM__PARTS_MAX];
    int groups, parts;
    int64_t step;
} dem__due_tests;
static inline void dem__test_due_groups(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    dem__due_tests *t = (dem__due_tests *)context;
    const ptrdiff_t pages = w->engine->pairs.timers.pages;
    dem__timer_batch *batch = &dem__work_of(w, part)->batch;
    (void)first, (void)end;
    for (int g = part; g < t->groups; g += t->parts) {
        const ptrdiff_t from = dem__part(pages, g, t->groups), to = dem__part(pages, g + 1, t->groups);
        if (w->engine->bodies.rigid) w->engine->bodies.calls->test_due(w, from, to, part, &t->step);
        else dem__test_due_range(w, from, to, part, &t->step);
        t->of[g].found = batch->found, t->of[g].touch = batch->touch, t->of[g].looks = batch->looks;
    }
}

/* Tests the due pairs. The number of threads follows from how many pairs were due in the step before. */
static inline void dem__test_due_pairs(dem_world *w, int64_t step) {
    dem__pairs *pairs = &w->engine->pairs;
    dem__due_tests t;
    t.parts = dem__parts_of(w, 4 * pairs->due_count, w->engine->scratch.works), t.step = step;
    t.groups = t.parts == 1 ? 1 : 8 * t.parts < DEM__PARTS_MAX ? 8 * t.parts : DEM__PARTS_MAX;
    if (t.groups > pairs->timers.pages) t.groups = (int)pairs->timers.pages;
    dem__in_parts(w, t.parts, t.parts, dem__test_due_groups, &t);
    pairs->due_count = 0;
    for (int g = 0; g < t.groups; g++) {
        pairs->due_count += (ptrdiff_t)t.of[g].looks;
        dem__new_pair_contacts(w, t.of[g].found, t.of[g].touch, t.of[g].looks);
    }
}

/* Tests all pairs that do not touch. */
static inline void dem__test_all_pairs(dem_world *w, int64_t step) {
    const dem__pairs *pairs = &w->engine->pairs;
    dem__timer_batch waits;
    dem__clear_batch(&waits);
    waits.found = pairs->timers.list;
    for (int32_t p = 0; p < (int32_t)pairs->count; p++) {
        if (pairs->timers.due[p] != DEM__STOPPED) dem__test_pair(w, &waits, p, step, 1);
    }
    dem__new_pair_contacts(w, waits.found, waits.touch, waits.looks);
}

/* Tests everything that is due at a step. */
static inline void dem__detect(dem_world *w, int64_t step) {
    dem__wall_state *walls = &w->engine->walls;
    DEM__TELL(w, follow, (w, step));
    DEM__TELL(w, detect, (w, step));
    if (!(w->def.skip & DEM_SKIP_PAIRS)) dem__test_all_pairs(w, step);
    if (!(w->def.skip & DEM_SKIP_SPACE)) {
        for (int32_t e = 0; e < (int32_t)(w->count * w->walls); e++) {
            if (dem__needs_test(w, e / w->walls, (int)(e % w->walls))) dem__test_wall(w, e, step);
        }
    }
    dem__test_due_pairs(w, step);
    ptrdiff_t n;
    dem__list_due(&walls->timers, 0, walls->timers.pages, step, DEM__STOPPED, &n);
    for (ptrdiff_t k = 0; k < n; k++) dem__test_wall(w, walls->timers.list[k], step);
}

/* Fails if a contact begins between two different materials whose pair was never set. Later runs fail at the same place
   until it is set. */
static DEM__NOINLINE void dem__check_pairs_set(dem_world *w) {
    const dem__contacts *contacts = &w->engine->contacts;
    const ptrdiff_t end = dem__next_slot(w);
    for (ptrdiff_t c = end - contacts->begun; c < end && w->status == DEM_OK; c++) {
        const int32_t i = contacts->i[c], j = contacts->j[c];
        const int a = w->material[i], b = j < 0 ? w->wall[-1 - j].material : w->material[j];
        const int low = a < b ? a : b, high = a < b ? b : a;
        if (low == high || w->def.pair[low][high].given) continue;
        w->status = DEM_PAIR_NOT_SET;
        w->failed_id = w->id[i];
        w->failed_pair[0] = low, w->failed_pair[1] = high;
        w->engine->run.needs_lists = 1; /* the next run must find these contacts again */
    }
}

/* Drops the contacts found in a step that cannot be finished. Returns 0. */
static DEM__NOINLINE int dem__undo_detection(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    for (; contacts->begun > 0; contacts->begun--) {
        const int32_t p = contacts->near[dem__next_slot(w) - 1];
        contacts->chunk[contacts->chunk_count - 1].count--;
        contacts->count--;
        if (p >= 0) w->engine->pairs.timers.due[p] = DEM__NEVER;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i] >= 0) continue;
        w->alive[i] = 1;
        if (dem__leads(w, i)) w->passed_count--, w->passed_total--;
    }
    w->engine->run.leaving = 0;
    for (int k = 0; k < w->walls; k++) dem__move_wall(&w->wall[k], w->time);
    return 0;
}
