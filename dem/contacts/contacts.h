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
    return dem__is_fixed(w, i) && dem__is_fixed(w, j);
}

/* Returns whether contact a comes before b: by i, the last first, then by j (walls last), then by element. */
DEM_INLINE int dem__before(const dem_world *w, int32_t a, int32_t b) {
    const dem__contacts *contacts = &w->engine->contacts;
    if (contacts->i[a] != contacts->i[b]) return contacts->i[a] > contacts->i[b];
    int64_t ja = contacts->j[a], jb = contacts->j[b];
    ja = ja < 0 ? INT32_MAX - ja : ja, jb = jb < 0 ? INT32_MAX - jb : jb;
    if (ja != jb) return ja < jb;
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

/* Lists the slots of contacts that have ended: of those that the last step marked, or of all. Returns their number. */
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

/* Moves the contacts in the listed slots, in that order, into the slots of chunks. This thread moves the arrays first,
   first + parts, ... */
static inline void dem__arrange_part(dem_world *w, const dem__chunk *chunk, int chunks, const dem__array *list,
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
    const dem__chunk *chunk;
    const dem__array *list;
    int chunks, arrays, parts;
} dem__arrangement;
static inline void dem__arrange_range(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *context) {
    const dem__arrangement *a = (const dem__arrangement *)context;
    (void)first, (void)end;
    dem__arrange_part(w, a->chunk, a->chunks, a->list, a->arrays, part, a->parts);
}
static inline void dem__arrange(dem_world *w, ptrdiff_t n, const dem__chunk *chunk, int chunks, const dem__array *list,
                                int arrays) {
    dem__arrangement a;
    a.chunk = chunk, a.list = list, a.chunks = chunks, a.arrays = arrays;
    a.parts = dem__parts_of(
        w, n, (int)(sizeof(dem__correction) / sizeof(double))); /* each needs an array of scratch memory */
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

/* Returns the curvature of a wall where a sphere touches it, in slot c, or touched it as the contact
   began. */
static inline double dem__curvature_at(const dem_world *w, ptrdiff_t c) {
    const dem__contacts *contacts = &w->engine->contacts;
    const dem_wall *wall = &w->wall[-1 - contacts->j[c]];
    const dem_particle *p = &w->particle[contacts->i[c]];
    dem__touch touch;
    if (dem__has(wall, DEM__KEEPS_CURVATURE)) return contacts->touch[DEM__KEPT_CURVATURE][c];
    dem__touch_element(wall, p->x, p->radius, contacts->element[c], &touch);
    return touch.curvature;
}

/* Computes the constants of the contact in slot c; shares those of a contact type that has the same. */
static inline void dem__set_constants(dem_world *w, ptrdiff_t c, const dem_law *law, int features) {
    const dem__run *run = &w->engine->run;
    dem__contacts *contacts = &w->engine->contacts;
    dem_birth b;
    dem__contact_type kind;
    const ptrdiff_t i = contacts->i[c], j = contacts->j[c];
    const double inertia = dem__inertia(w, i);
    int same =
        contacts->type_count > DEM__TYPES_MAX ? contacts->type_count : 0; /* more types than fit: none is searched */
    memset(&b, 0, sizeof b);
    memset(&kind, 0, sizeof kind);
    b.def = &w->def;
    b.features = features;
    b.material_i = w->material[i];
    b.radius_i = w->particle[i].radius;
    if (j >= 0) {
        double other = dem__inertia(w, j);
        b.material_j = w->material[j];
        b.radius_j = w->particle[j].radius;
        b.mass = w->particle[i].mass * w->particle[j].mass / (w->particle[i].mass + w->particle[j].mass);
        b.inertia = inertia * other / (inertia + other);
        if (dem__is_fixed(w, i)) b.mass = w->particle[j].mass, b.inertia = other;
        if (dem__is_fixed(w, j)) b.mass = w->particle[i].mass, b.inertia = inertia;
    } else {
        b.material_j = w->wall[-1 - j].material;
        b.mass = w->particle[i].mass;
        b.inertia = inertia;
    }
    if (dem__is_convex_contact(w, c)) w->engine->convex.calls->prepare(w, c, &b);
    else if (j < 0) b.curvature = dem__curvature_at(w, c);
    b.pair = b.material_i < b.material_j ? &w->def.pair[b.material_i][b.material_j]
                                         : &w->def.pair[b.material_j][b.material_i];
    b.user = w->user;
    b.damping_ratio = run->damping_ratio[b.material_i][b.material_j];
    const double stiffness = law->prepare(&b, kind.constant);
    kind.mass = b.mass;
    kind.sum = b.radius_i + b.radius_j;
    kind.part = b.radius_i / kind.sum;
    const double k = stiffness * run->dt * run->dt / b.mass;
    if (k > w->engine->run.stiffest) w->engine->run.stiffest = k;
    kind.predict = dem__prediction(k, 2.0 * b.damping_ratio * sqrt(k));
    while (same < contacts->type_count && memcmp(&contacts->types[same], &kind, sizeof kind) != 0) same++;
    if (same < DEM__TYPES_MAX) {
        contacts->type[c] = same;
        contacts->types[same] = kind;
        contacts->type_count += same == contacts->type_count;
        return;
    }
    contacts->type_count =
        DEM__TYPES_MAX +
        1; /* from now on each contact has its own: to search the types would cost more than it saves */
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

/* Moves the contacts that began since the last call, listed by partners, from the end of the last chunk into their
   chunks, and lists their slots there. */
static inline void dem__distribute_begun(dem_world *w, const dem__array *list, int arrays) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__chunk born[DEM__CHUNKS];
    const int last = contacts->chunk_count - 1;
    ptrdiff_t n = 0;
    contacts->chunk[last].count -= contacts->begun;
    for (int q = 0; q <= last; q++) {
        dem__chunk *in = &contacts->chunk[q];
        born[q].first = in->first + in->count;
        born[q].count = 0;
    }
    for (ptrdiff_t k = 0, q = 0; k < contacts->begun; k++) {
        while (contacts->i[contacts->slots[k]] < contacts->chunk[q].first_particle) q++;
        if (q < last && contacts->chunk[q].count + born[q].count == contacts->chunk[q].capacity)
            q = last; /* and so are all after it */
        born[q].count++;
    }
    if (last > 0 || !dem__ascends(contacts->slots, contacts->begun))
        dem__arrange(w, contacts->begun, born, contacts->chunk_count, list, arrays);
    for (int q = 0; q <= last; q++) {
        contacts->chunk[q].count += born[q].count;
        for (ptrdiff_t c = born[q].first; c < born[q].first + born[q].count; c++) {
            contacts->slots[n++] = (int32_t)c;
        }
    }
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
    dem__sort(w, contacts->slots, born);
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
        contacts->edge[c] = contacts->ended[c] = 0;
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
    const int32_t p = contacts->near[c];
    dem__prefetch_flight(w, contacts->i[c]);
    if (p < 0 || p >= w->engine->pairs.count) return; /* its list may be gone */
    dem__prefetch_flight(w, contacts->j[c]);
    DEM__PREFETCH(&w->engine->pairs.near[p]);
    DEM__PREFETCH(&w->engine->pairs.timers.due[p]);
}

/* Ends the contact in slot c and sets its timer anew. */
static inline void dem__end_contact(dem_world *w, dem__timer_batch *waits, int32_t c, int64_t step) {
    const ptrdiff_t i = w->engine->contacts.i[c], j = w->engine->contacts.j[c];
    const int32_t near_pair = w->engine->contacts.near[c];
    dem__report_end(w, w->engine->run.law, dem__number_of(w, c));
    dem__count_contact(w, i, -1);
    dem__mark_to_check(w, i);
    DEM__TELL(w, end_contact, (w, c));
    if (j >= 0) {
        dem__count_contact(w, j, -1);
        dem__mark_to_check(w, j);
        if (near_pair < 0 || w->engine->run.needs_lists) return;
        if (!(w->alive[i] > 0 && w->alive[j] > 0)) return;
        w->engine->pairs.timers.due[near_pair] = DEM__NEVER;
        if (w->def.skip & DEM_SKIP_PAIRS)
            dem__batch_separation(w, waits, near_pair, step, dem__pair_separation(w, i, j, step));
        return;
    }
    dem__unlink_wall_contact(w, i, c, -1);
    /* a screen's timer was running for its other bars, but not for this one */
    if (!w->engine->run.needs_lists && w->alive[i] > 0 && (w->def.skip & DEM_SKIP_SPACE) &&
        dem__needs_test(w, i, -1 - (int)j))
        dem__set_timer(&w->engine->walls.timers, (int32_t)i * w->walls - 1 - (int32_t)j, step + 1);
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

/* Removes contacts that ended: those that the last step marked, or all. Contacts at the end of their chunk fill the
   gaps. */
static inline void dem__remove_ended(dem_world *w, int64_t step, int all) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__array list[DEM__ARRAYS_MAX];
    const ptrdiff_t dead = dem__list_ended(w, all);
    if (dead == 0) return;
    const int n = dem__kept_arrays(w, list);
    ptrdiff_t next = 0;
    dem__timer_batch waits;
    dem__clear_batch(&waits);
    for (ptrdiff_t k = dem__prefetch_from(dead, DEM__AHEAD); k < dead; k++) {
        if (k + DEM__AHEAD < dead) dem__prefetch_end(w, contacts->slots[k + DEM__AHEAD]);
        if (k >= 0) dem__end_contact(w, &waits, contacts->slots[k], step);
    }
    dem__flush_batch(w, &waits, step);
    contacts->count -= dead;
    for (int q = 0; q < contacts->chunk_count; q++) {
        dem__chunk *in = &contacts->chunk[q];
        const ptrdiff_t first = next;
        ptrdiff_t last = in->first + in->count;
        while (next < dead && contacts->slots[next] < last) next++;
        in->count -= next - first;
        for (ptrdiff_t k = first; k < next && contacts->slots[k] < in->first + in->count; k++) {
            while (contacts->ended[last - 1]) last--;
            dem__move_contact(w, (int32_t)--last, contacts->slots[k], list, n);
        }
    }
}

/* Orders all contacts by their particles i, the last first, otherwise as they were: neighbours in space are then read
   one after the other. Many contacts are in chunks of equal size, with room to grow. Returns 0 when out of memory. */
static inline int dem__reorder_contacts(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    const ptrdiff_t n = contacts->count;
    const int chunks = n < DEM__CHUNKS * 512 ? 1 : DEM__CHUNKS;
    dem__chunk chunk[DEM__CHUNKS];
    dem__array list[DEM__ARRAYS_MAX];
    int32_t *place = w->engine->scratch.index, sum = 0, before = INT32_MAX;
    ptrdiff_t end = 0, cut = 0;
    int in_order = chunks == contacts->chunk_count;
    DEM__EACH_CONTACT(w, c) {
        in_order &= before >= contacts->i[c];
        before = contacts->i[c];
    }
    if (!in_order) {
        for (ptrdiff_t i = 0; i < w->count; i++) place[i] = 0;
        DEM__EACH_CONTACT(w, c) { place[contacts->i[c]]++; }
        for (ptrdiff_t i = w->count - 1; i >= 0; i--) {
            const int32_t of = place[i];
            place[i] = sum;
            sum += of;
        }
        DEM__EACH_CONTACT(w, c) { contacts->slots[place[contacts->i[c]]++] = (int32_t)c; }
        memset(chunk, 0, sizeof chunk);
        for (int q = 0; q < chunks; q++) {
            const ptrdiff_t first = cut;
            if (dem__part(n, q + 1, chunks) > cut) cut = dem__part(n, q + 1, chunks);
            while (cut < n && contacts->i[contacts->slots[cut]] == contacts->i[contacts->slots[cut - 1]]) cut++;
            chunk[q].first_particle = q < chunks - 1 ? contacts->i[contacts->slots[cut - 1]] : 0;
            chunk[q].first = end;
            chunk[q].count = cut - first;
            chunk[q].capacity = chunks > 1 ? chunk[q].count + chunk[q].count / 4 + DEM__BLOCK : 0;
            end += chunk[q].capacity;
        }
        if (!dem__grow_contacts(w, end + 1)) {
            w->status = DEM_OUT_OF_MEMORY;
            return 0;
        }
        dem__arrange(w, n, chunk, chunks, list, dem__kept_arrays(w, list));
        contacts->chunk_count = chunks;
        memcpy(contacts->chunk, chunk, sizeof chunk);
        dem__list_wall_contacts(w);
    }
    return 1;
}
