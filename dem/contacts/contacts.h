/* Contacts that begin and end, and their order in slots. Reads bodies, walls, the law; writes contacts, activity and
   timers. Promises: the order depends only on the history of the scene, never on threads. */
#pragma once
#include "../walls/kinds.h"
#include "laws.h"
#include "kernel.h"

/* Calls the law's hook for a contact or a link that has ended. */
static inline void dem__report_end(dem_world *w, const dem_law *law, int32_t k) {
    if (!law || !law->ended) return;
    w->engine->run.ending = 1;
    law->ended(w, k, w->user);
    w->engine->run.ending = 0;
}

/* Returns whether the caller ended the contact of i and j: by changing the wall, or by fixing particles. */
static inline int dem__is_taken_away(const dem_world *w, ptrdiff_t i, ptrdiff_t j) {
    if (j < 0) return !dem__is_at_wall(w, i, -1 - (int)j) || dem__is_fixed(w, i);
    return dem__cannot_meet(w, i, j);
}

/* Returns the lower rank of the contact in slot c. */
DEM_INLINE int32_t dem__rank_in_slot(const dem_world *w, ptrdiff_t c) {
    return dem__lower_rank(w, w->engine->contacts.i[c], w->engine->contacts.j[c]);
}

/* Returns the rank of the other particle of a contact; walls come after all particles. */
DEM_INLINE int64_t dem__other_rank(const dem_world *w, int32_t i, int32_t j) {
    const int32_t *rank = w->engine->bodies.rank;
    if (j < 0) return INT32_MAX - (int64_t)j;
    return rank[i] < rank[j] ? rank[j] : rank[i];
}

/* Returns whether contact a comes before b. The last lower rank of the two particles comes first, then the other rank
   counts (walls last), then the element. */
DEM_INLINE int dem__before(const dem_world *w, int32_t a, int32_t b) {
    const dem__contacts *contacts = &w->engine->contacts;
    const int32_t low_a = dem__rank_in_slot(w, a), low_b = dem__rank_in_slot(w, b);
    if (low_a != low_b) return low_a > low_b;
    const int64_t other_a = dem__other_rank(w, contacts->i[a], contacts->j[a]),
                  other_b = dem__other_rank(w, contacts->i[b], contacts->j[b]);
    if (other_a != other_b) return other_a < other_b;
    return contacts->element[a] < contacts->element[b];
}

static inline void dem__sift(const dem_world *w, int32_t *heap, ptrdiff_t root, ptrdiff_t n) {
    for (;;) {
        ptrdiff_t child = 2 * root + 1;
        if (child >= n) return;
        if (child + 1 < n && dem__before(w, heap[child], heap[child + 1])) child++;
        if (!dem__before(w, heap[root], heap[child])) return;
        int32_t t = heap[root];
        heap[root] = heap[child], heap[child] = t;
        root = child;
    }
}

static inline void dem__sort(const dem_world *w, int32_t *slots, ptrdiff_t n) {
    for (ptrdiff_t k = n / 2 - 1; k >= 0; k--) dem__sift(w, slots, k, n);
    for (ptrdiff_t k = n - 1; k > 0; k--) {
        int32_t t = slots[0];
        slots[0] = slots[k], slots[k] = t;
        dem__sift(w, slots, 0, k);
    }
}

/* Lists the slots of contacts that have ended: those that the last step marked, or all. Returns how many. */
static inline ptrdiff_t dem__list_ended(dem_world *w, int all) {
    dem__contacts *contacts = &w->engine->contacts;
    ptrdiff_t n = 0;
    for (const dem__chunk *in = contacts->chunk; in < contacts->chunk + contacts->chunk_count; in++) {
        for (ptrdiff_t k = 0; k < (all ? in->count : in->marked); k++) {
            const ptrdiff_t c = all ? in->first + k : contacts->slots[in->first + k];
            if (contacts->ended[c]) contacts->slots[n++] = (int32_t)c;
        }
    }
    return n;
}

/* Copies one element of an array, most often of 8 or 4 bytes. */
DEM_INLINE void dem__copy(char *to, const char *from, size_t size) {
    if (size == 8) memcpy(to, from, 8);
    else if (size == 4) memcpy(to, from, 4);
    else *to = *from;
}

/* Gathers the n elements of an array that `from` lists. */
static inline void dem__gather_items(char *to, const char *base, size_t size, const int32_t *from, ptrdiff_t n) {
    for (ptrdiff_t k = 0; k < n; k++) dem__copy(to + (size_t)k * size, base + (size_t)from[k] * size, size);
}

/* Slots that follow each other. */
typedef struct dem__run_of_slots {
    ptrdiff_t first, count;
} dem__run_of_slots;

/* Moves the contacts in the listed slots, in that order, into runs of slots. This thread moves the arrays first, first
   + parts, ... */
static inline void dem__arrange_part(dem_world *w, const dem__run_of_slots *chunk, int chunks, const dem__array *list,
                                     int arrays, int first, int parts) {
    const dem__contacts *contacts = &w->engine->contacts;
    char *scratch = (char *)contacts->correction + (size_t)first * (size_t)contacts->capacity * sizeof(double);
    ptrdiff_t n = 0;
    for (int q = 0; q < chunks; q++) n += chunk[q].count;
    for (int a = first; a < arrays; a += parts) {
        const size_t size = list[a].size;
        const char *from = scratch;
        char *base;
        memcpy(&base, list[a].address, sizeof base);
        dem__gather_items(scratch, base, size, contacts->slots, n);
        for (int q = 0; q < chunks; q++) {
            const size_t bytes = (size_t)chunk[q].count * size;
            memcpy(base + (size_t)chunk[q].first * size, from, bytes);
            from += bytes;
        }
    }
}
typedef struct dem__arrangement {
    const dem__run_of_slots *chunk;
    const dem__array *list;
    int chunks, arrays, parts;
} dem__arrangement;
static inline void dem__arrange_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__arrangement *a = (const dem__arrangement *)context;
    (void)first, (void)end;
    dem__arrange_part(w, a->chunk, a->chunks, a->list, a->arrays, part, a->parts);
}
static inline void dem__arrange(dem_world *w, ptrdiff_t n, const dem__run_of_slots *chunk, int chunks,
                                const dem__array *list, int arrays) {
    dem__arrangement a;
    a.chunk = chunk, a.list = list, a.chunks = chunks, a.arrays = arrays;
    a.parts = dem__parts_of(
        w, n, (int)(sizeof(dem__correction) / sizeof(double))); /* each thread needs scratch memory for an array */
    dem__in_parts(w, a.parts, a.parts, dem__arrange_range, &a);
}

/* Changes the number of contacts of particle i, and of all particles of its rigid body. */
DEM_INLINE void dem__count_contact(dem_world *w, ptrdiff_t i, int change) {
    const dem__pieces own = dem__pieces_of(w, i);
    for (ptrdiff_t k = own.first; k < own.end; k++) {
        w->touching[k] += change;
        dem__set_mass_share(w, k);
    }
}

DEM_INLINE void dem__activate(dem_world *w, ptrdiff_t i) {
    dem__count_contact(w, i, 1);
    dem__wake(w, i);
}

/* Returns the curvature of the wall where the sphere of the contact in slot c touches it, or touched it when the
   contact began. */
static inline double dem__curvature_at(const dem_world *w, ptrdiff_t c) {
    const dem__contacts *contacts = &w->engine->contacts;
    const dem_wall *wall = &w->wall[-1 - contacts->j[c]];
    const dem_particle *p = &w->particle[contacts->i[c]];
    dem__touch touch;
    if (dem__has(wall, DEM__KEEPS_CURVATURE)) return contacts->touch[DEM__KEPT_CURVATURE][c];
    dem__touch_element(wall, p->x, p->radius, contacts->element[c], &touch);
    return touch.curvature;
}

/* Computes the constants of the contact in slot c. Contacts with the same sizes and materials share those of a contact
   type. */
static inline void dem__set_constants(dem_world *w, ptrdiff_t c, const dem_law *law, int features) {
    const dem__run *run = &w->engine->run;
    dem__contacts *contacts = &w->engine->contacts;
    dem_birth b;
    dem__contact_type kind;
    const ptrdiff_t i = contacts->i[c], j = contacts->j[c];
    const double inertia = dem__inertia(w, i);
    int same = contacts->type_count > DEM__TYPES_MAX ? contacts->type_count : 0; /* too many types: none is searched */
    memset(&b, 0, sizeof b);
    memset(&kind, 0, sizeof kind);
    b.def = &w->def;
    b.features = features;
    b.material_i = w->material[i];
    b.radius_i = w->particle[i].radius;
    if (j >= 0) {
        b.material_j = w->material[j];
        b.radius_j = w->particle[j].radius;
        b.mass = dem__reduced(w, i, j, w->particle[i].mass, w->particle[j].mass);
        b.inertia = dem__reduced(w, i, j, inertia, dem__inertia(w, j));
    } else {
        b.material_j = w->wall[-1 - j].material;
        b.mass = w->particle[i].mass;
        b.inertia = inertia;
    }
    const int is_convex = dem__is_convex_contact(w, c);
    if (is_convex) w->engine->convex.calls->prepare(w, c, &b);
    else if (j < 0) b.curvature = dem__curvature_at(w, c);
    b.pair = b.material_i < b.material_j ? &w->def.pair[b.material_i][b.material_j]
                                         : &w->def.pair[b.material_j][b.material_i];
    b.user = w->user;
    b.damping_ratio = run->damping_ratio[b.material_i][b.material_j];
    const double stiffness = law->prepare(&b, kind.constant);
    kind.mass = b.mass;
    kind.sum = b.radius_i + b.radius_j;
    kind.part = b.radius_i / kind.sum;
    const double k = stiffness * run->dt * run->dt / b.mass, own = is_convex ? dem__rate_of(w, i) : 1.0,
                 other = is_convex && j >= 0 ? dem__rate_of(w, j) : 1.0, rate = own > other ? own : other;
    if (rate * k > w->engine->run.stiffest) w->engine->run.stiffest = rate * k;
    kind.predict = dem__prediction(k, 2.0 * b.damping_ratio * sqrt(k));
    while (same < contacts->type_count && memcmp(&contacts->types[same], &kind, sizeof kind) != 0) same++;
    if (same < DEM__TYPES_MAX) {
        contacts->type[c] = same;
        contacts->types[same] = kind;
        contacts->type_count += same == contacts->type_count;
        return;
    }
    /* from here on each has its own: a search would cost more than it saves */
    contacts->type_count = DEM__TYPES_MAX + 1;
    contacts->type[c] = -1;
    for (int a = 0; a < law->constants; a++) contacts->constant[a][c] = kind.constant[a];
    contacts->mass[c] = kind.mass;
    contacts->predict[c] = kind.predict;
    contacts->sum[c] = kind.sum;
    contacts->part[c] = kind.part;
}

DEM_INLINE int dem__ascends(const int32_t *list, ptrdiff_t n) {
    for (ptrdiff_t k = 1; k < n; k++) {
        if (list[k] < list[k - 1]) return 0;
    }
    return 1;
}

/* Moves the contacts that began since the last call from the end of the last chunk into their chunks, and lists their
   slots there. contacts.slots lists them, sorted by partners. */
static inline void dem__distribute_begun(dem_world *w, const dem__array *list, int arrays) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__run_of_slots born[DEM__CHUNKS]; /* for chunks that get any */
    int32_t to[DEM__CHUNKS];
    const int last = contacts->chunk_count - 1;
    ptrdiff_t n = 0;
    int runs = 0;
    contacts->chunk[last].count -= contacts->begun;
    for (ptrdiff_t k = 0, q = 0; k < contacts->begun; k++) {
        const int32_t low = dem__rank_in_slot(w, contacts->slots[k]);
        while (low < contacts->chunk[q].first_rank) q++;
        const ptrdiff_t waiting = runs > 0 && to[runs - 1] == (int32_t)q ? born[runs - 1].count : 0;
        if (q < last && contacts->chunk[q].count + waiting == contacts->chunk[q].capacity)
            q = last; /* so do all that follow */
        if (runs == 0 || to[runs - 1] != (int32_t)q) {
            to[runs] = (int32_t)q;
            born[runs].first = contacts->chunk[q].first + contacts->chunk[q].count, born[runs++].count = 0;
        }
        born[runs - 1].count++;
    }
    if (last > 0 || !dem__ascends(contacts->slots, contacts->begun))
        dem__arrange(w, contacts->begun, born, runs, list, arrays);
    for (int q = 0; q < runs; q++) {
        contacts->chunk[to[q]].count += born[q].count;
        for (ptrdiff_t c = born[q].first; c < born[q].first + born[q].count; c++) {
            contacts->slots[n++] = (int32_t)c;
        }
    }
}

/* Sorts the listed slots of n contacts that begin: first by chunk, because each chunk gets few. */
static inline void dem__sort_begun(dem_world *w, ptrdiff_t n) {
    dem__contacts *contacts = &w->engine->contacts;
    int32_t *chunk = w->engine->pairs.timers.list, *slot = chunk + n, start[DEM__CHUNKS + 1];
    const int chunks = contacts->chunk_count;
    if (chunks == 1 || 2 * n > w->engine->pairs.timers.pages * DEM__PAGE) {
        dem__sort(w, contacts->slots, n);
        return;
    }
    memset(start, 0, sizeof start);
    for (ptrdiff_t k = 0; k < n; k++) {
        const int32_t low = dem__rank_in_slot(w, contacts->slots[k]);
        int from = 0, to = chunks - 1;
        while (from < to) {
            const int middle = (from + to) / 2;
            if (contacts->chunk[middle].first_rank <= low) to = middle;
            else from = middle + 1;
        }
        chunk[k] = from, slot[k] = contacts->slots[k];
        start[from + 1]++;
    }
    for (int q = 0; q < chunks; q++) start[q + 1] += start[q];
    /* start: from here on the end of each chunk */
    for (ptrdiff_t k = 0; k < n; k++) contacts->slots[start[chunk[k]]++] = slot[k];
    for (int q = 0, from = 0; q < chunks; from = start[q++]) dem__sort(w, contacts->slots + from, start[q] - from);
}

/* Completes the contacts that began since the last call, and puts them into the order. gap: before this step [m]. */
static inline void dem__commit_begun(dem_world *w, double gap) {
    dem__wall_state *walls = &w->engine->walls;
    dem__contacts *contacts = &w->engine->contacts;
    const ptrdiff_t born = contacts->begun, old = dem__next_slot(w) - born;
    dem__array list[4 + DEM__PLACES] = {{&contacts->i, sizeof(int32_t)},
                                        {&contacts->j, sizeof(int32_t)},
                                        {&contacts->element, sizeof(int32_t)},
                                        {&contacts->near, sizeof(int32_t)}};
    int arrays = 4;
    for (int a = 0; walls->touch_keepers && a < DEM__PLACES; a++, arrays++)
        list[arrays].address = &contacts->touch[a], list[arrays].size = sizeof(double);
    if (!born) return;
    for (ptrdiff_t k = 0; k < born; k++) contacts->slots[k] = (int32_t)(old + k);
    dem__sort_begun(w, born);
    dem__distribute_begun(w, list, arrays);
    for (ptrdiff_t k = 0; k < born; k++) {
        const ptrdiff_t c = contacts->slots[k], i = contacts->i[c], j = contacts->j[c];
        dem__activate(w, i);
        if (j >= 0) dem__activate(w, j);
        else {
            contacts->wall_next[c] = walls->first_contact[i];
            walls->first_contact[i] = (int32_t)c;
        }
        for (int a = 0; a < contacts->states; a++) contacts->state[a][c] = 0.0;
        contacts->gap[c] = gap;
        contacts->force[c] = 0.0;
        contacts->partial[c] = contacts->ended[c] = 0;
    }
    contacts->begun = 0;
}

/* Calls the law's born hook for the contacts in the listed slots. */
static inline void dem__report_begun(dem_world *w, const dem_law *law, ptrdiff_t born) {
    dem__contacts *contacts = &w->engine->contacts;
    if (!law->born || born == 0) return;
    for (ptrdiff_t k = 0; k < born; k++) contacts->slots[k] = dem__number_of(w, contacts->slots[k]);
    law->born(w, contacts->slots, born, w->user);
}

static inline void dem__unlink_wall_contact(dem_world *w, ptrdiff_t i, int32_t slot, int32_t replacement) {
    int32_t *link = &w->engine->walls.first_contact[i];
    while (*link >= 0 && *link != slot) link = &w->engine->contacts.wall_next[*link];
    if (*link == slot) *link = replacement >= 0 ? replacement : w->engine->contacts.wall_next[slot];
}

/* Prefetches what a check of a particle's bound reads. */
DEM_INLINE void dem__prefetch_flight(const dem_world *w, ptrdiff_t i) {
    dem__prefetch_particle(w, i);
    DEM__PREFETCH(&w->engine->bodies.bound[i]);
}

/* Prefetches what the end of a contact reads. */
DEM_INLINE void dem__prefetch_end(const dem_world *w, ptrdiff_t c) {
    const dem__contacts *contacts = &w->engine->contacts;
    const int32_t p = contacts->near[c], i = contacts->i[c], j = contacts->j[c];
    dem__prefetch_flight(w, i);
    DEM__PREFETCH(&w->touching[i]);
    DEM__PREFETCH(&w->engine->bodies.mass_share[i]);
    DEM__PREFETCH(&w->engine->bodies.activity[i]);
    if (p < 0 || p >= w->engine->pairs.count) return; /* the list of pairs may be gone */
    dem__prefetch_flight(w, j);
    DEM__PREFETCH(&w->touching[j]);
    DEM__PREFETCH(&w->engine->bodies.mass_share[j]);
    DEM__PREFETCH(&w->engine->bodies.activity[j]);
    DEM__PREFETCH(&w->engine->pairs.near[p]);
    DEM__PREFETCH(&w->engine->pairs.timers.due[p]);
}

/* Ends the contact in slot c. Returns its near pair if that needs a new timer, otherwise -1. */
static inline int32_t dem__end_contact(dem_world *w, int32_t c, int64_t step) {
    const ptrdiff_t i = w->engine->contacts.i[c], j = w->engine->contacts.j[c];
    const int32_t near_pair = w->engine->contacts.near[c];
    dem__report_end(w, w->engine->run.law, dem__number_of(w, c));
    dem__count_contact(w, i, -1);
    dem__mark_to_check(w, i);
    DEM__TELL(w, end_contact, (w, c));
    if (j >= 0) {
        dem__count_contact(w, j, -1);
        dem__mark_to_check(w, j);
        if (near_pair < 0 || w->engine->run.needs_lists) return -1;
        if (!(w->alive[i] > 0 && w->alive[j] > 0)) return -1;
        w->engine->pairs.timers.due[near_pair] = DEM__NEVER;
        return w->def.skip & DEM_SKIP_PAIRS ? near_pair : -1;
    }
    dem__unlink_wall_contact(w, i, c, -1);
    /* a screen's timer ran for its other bars, but not for this one */
    if (!w->engine->run.needs_lists && w->alive[i] > 0 && (w->def.skip & DEM_SKIP_SPACE) &&
        dem__needs_test(w, i, -1 - (int)j))
        dem__set_timer(&w->engine->walls.timers, (int32_t)i * w->walls - 1 - (int32_t)j, step + 1);
    return -1;
}

/* Near pairs whose contacts have ended, and the step from which they are apart. */
typedef struct dem__parted {
    const int32_t *pair;
    int32_t *list; /* pairs and steps */
    int64_t step;
} dem__parted;
static inline void dem__batch_parted(dem_world *w, dem__timer_batch *waits, int32_t p, int64_t step) {
    const dem__near *q = &w->engine->pairs.near[p];
    dem__batch_separation(w, waits, p, step, dem__pair_separation(w, q->i, q->j, step));
}
static inline void dem__list_parted(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__parted *t = (const dem__parted *)context;
    ptrdiff_t n = first;
    dem__timer_batch waits;
    dem__clear_batch(&waits);
    (void)part;
    for (ptrdiff_t k = first; k < end; k++) {
        if (waits.n == DEM__BLOCK) n = dem__list_batch(w, &waits, t->list, n);
        dem__batch_parted(w, &waits, t->pair[k], t->step);
    }
    dem__list_batch(w, &waits, t->list, n);
}
/* Sets the timers of n near pairs whose contacts have ended. */
static inline void dem__set_parted(dem_world *w, const int32_t *pair, ptrdiff_t n, int64_t step) {
    const int parts = dem__parts(w, 8 * n);
    dem__parted t;
    t.pair = pair, t.list = w->engine->pairs.timers.list, t.step = step;
    if (parts > 1 && 2 * n <= w->engine->pairs.timers.pages * DEM__PAGE) {
        dem__in_parts(w, parts, n, dem__list_parted, &t);
        dem__set_listed(w, t.list, n, step);
        return;
    }
    dem__timer_batch waits;
    dem__clear_batch(&waits);
    for (ptrdiff_t k = 0; k < n; k++) dem__batch_parted(w, &waits, pair[k], step);
    dem__flush_batch(w, &waits, step);
}

/* Moves the contact in slot `from` into a free slot. */
static inline void dem__move_contact(dem_world *w, int32_t from, int32_t to, const dem__array *list, int n) {
    dem__contacts *contacts = &w->engine->contacts;
    if (contacts->j[from] < 0) {
        contacts->wall_next[to] = contacts->wall_next[from];
        dem__unlink_wall_contact(w, contacts->i[from], from, to);
    }
    for (int a = 0; a < n; a++) {
        char *base;
        memcpy(&base, list[a].address, sizeof base);
        dem__copy(base + (size_t)to * list[a].size, base + (size_t)from * list[a].size, list[a].size);
    }
}

/* The listed slots of contacts that have ended; for each chunk, where its slots begin in the list. */
typedef struct dem__gaps {
    int32_t first[DEM__CHUNKS + 1];
    dem__array list[DEM__ARRAYS_MAX];
    int arrays;
} dem__gaps;
/* Fills the gaps in chunks first .. end-1 with contacts from the ends of the chunks. */
static inline void dem__fill_gaps(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    dem__contacts *contacts = &w->engine->contacts;
    const dem__gaps *gaps = (const dem__gaps *)context;
    (void)part;
    for (ptrdiff_t q = first; q < end; q++) {
        dem__chunk *in = &contacts->chunk[q];
        const ptrdiff_t from = gaps->first[q], to = gaps->first[q + 1];
        ptrdiff_t last = in->first + in->count;
        in->count -= to - from;
        for (ptrdiff_t k = from; k < to && contacts->slots[k] < in->first + in->count; k++) {
            while (contacts->ended[last - 1]) last--;
            dem__move_contact(w, (int32_t)--last, contacts->slots[k], gaps->list, gaps->arrays);
        }
    }
}

/* Removes contacts that ended: those that the last step marked, or all. Contacts at the end of their chunk fill the
   gaps. */
static inline void dem__remove_ended(dem_world *w, int64_t step, int all) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__gaps gaps;
    ptrdiff_t next = 0, parted = 0;
    const ptrdiff_t dead = dem__list_ended(w, all);
    if (dead == 0) return;
    int32_t *pair = w->engine->pairs.cell_of; /* used only by a rebuild */
    for (ptrdiff_t k = dem__prefetch_from(dead, DEM__AHEAD); k < dead; k++) {
        if (k + DEM__AHEAD < dead) dem__prefetch_end(w, contacts->slots[k + DEM__AHEAD]);
        if (k < 0) continue;
        const int32_t p = dem__end_contact(w, contacts->slots[k], step);
        if (p < 0) continue;
        pair[parted++] = p;
        if (parted < w->count) continue;
        dem__set_parted(w, pair, parted, step);
        parted = 0;
    }
    dem__set_parted(w, pair, parted, step);
    contacts->count -= dead;
    for (int q = 0; q < contacts->chunk_count; q++) {
        const dem__chunk *in = &contacts->chunk[q];
        gaps.first[q] = (int32_t)next;
        while (next < dead && contacts->slots[next] < in->first + in->count) next++;
    }
    gaps.first[contacts->chunk_count] = (int32_t)dead;
    gaps.arrays = dem__kept_arrays(w, gaps.list);
    /* the last chunk may hold contacts of a particle whose other contacts lie in another chunk, so it follows
       afterwards */
    const int chunks = contacts->chunk_count - 1;
    if (chunks > 0) dem__in_parts(w, dem__parts_of(w, 8 * dead, chunks), chunks, dem__fill_gaps, &gaps);
    dem__fill_gaps(w, chunks, chunks + 1, 0, &gaps);
}
