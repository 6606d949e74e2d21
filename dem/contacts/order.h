/* The order of contacts in memory: by place, in chunks of equal size that threads share. Reads ranks; writes contacts.
   Promises: the order depends only on the history of the scene, never on threads. */
#pragma once
#include "contacts.h"

/* Returns the number of chunks for n contacts. */
static inline int dem__chunks_for(ptrdiff_t n) {
    if (n < DEM__CHUNKED) return 1;
    const ptrdiff_t equal = n / (DEM__OF_CHUNK * DEM__EQUAL_CHUNKS);
    const ptrdiff_t chunks = (equal > 1 ? equal : 1) * DEM__EQUAL_CHUNKS;
    return chunks < DEM__CHUNKS ? (int)chunks : DEM__CHUNKS;
}

/* Returns whether contacts lie in the order of ranks, the last rank first. */
static inline int dem__are_in_order(const dem_world *w) {
    const dem__contacts *contacts = &w->engine->contacts;
    int32_t before = INT32_MAX;
    int in_order = dem__chunks_for(contacts->count) == contacts->chunk_count;
    DEM__EACH_CONTACT(w, c) {
        const int32_t low = dem__rank_in_slot(w, c);
        in_order &= before >= low;
        before = low;
    }
    return in_order;
}

/* Lists the slots of contacts in the order of ranks, the last rank first; contacts of the same rank keep their
   order. */
static inline void dem__list_by_rank(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    int32_t *place = w->engine->scratch.index, sum = 0;
    for (ptrdiff_t r = 0; r < w->count; r++) place[r] = 0;
    DEM__EACH_CONTACT(w, c) { place[dem__rank_in_slot(w, c)]++; }
    for (ptrdiff_t r = w->count - 1; r >= 0; r--) {
        const int32_t of = place[r];
        place[r] = sum;
        sum += of;
    }
    DEM__EACH_CONTACT(w, c) { contacts->slots[place[dem__rank_in_slot(w, c)]++] = (int32_t)c; }
}

/* Divides the listed contacts among chunks of equal size, with room to grow. */
static inline void dem__cut_chunks(dem_world *w, int chunks, dem__run_of_slots *run) {
    dem__contacts *contacts = &w->engine->contacts;
    const ptrdiff_t n = contacts->count;
    ptrdiff_t end = 0, cut = 0;
    for (int q = 0; q < chunks; q++) {
        const ptrdiff_t first = cut;
        dem__chunk *in = &contacts->chunk[q];
        if (dem__part(n, q + 1, chunks) > cut) cut = dem__part(n, q + 1, chunks);
        while (cut < n && dem__rank_in_slot(w, contacts->slots[cut]) == dem__rank_in_slot(w, contacts->slots[cut - 1]))
            cut++;
        memset(in, 0, sizeof *in);
        in->first_rank = q < chunks - 1 ? dem__rank_in_slot(w, contacts->slots[cut - 1]) : 0;
        in->first = run[q].first = end, in->count = run[q].count = cut - first;
        in->capacity = chunks > 1 ? in->count + in->count / 4 + DEM__BLOCK : 0;
        end += in->capacity;
    }
    contacts->chunk_count = chunks;
}

/* Returns whether contacts must be ordered again: a few contacts always, many seldom or when chunks are full. */
static inline int dem__is_order_due(const dem_world *w) {
    const dem__contacts *contacts = &w->engine->contacts;
    const int chunks = contacts->chunk_count;
    return chunks == 1 || w->step % DEM__RANK_STEPS == 0 ||
           contacts->chunk[chunks - 1].count > 2 * (contacts->count / chunks) + DEM__BLOCK;
}

/* Orders all contacts by the ranks of their particles, the last rank first, so that neighbours in space are read one
   after the other; contacts of the same rank keep their order. Many contacts lie in chunks of equal size, with room to
   grow; then ranks are renewed, too. Returns 0 when out of memory. */
static inline int dem__reorder_contacts(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    const ptrdiff_t n = contacts->count;
    const int chunks = dem__chunks_for(n);
    dem__run_of_slots run[DEM__CHUNKS];
    dem__array list[DEM__ARRAYS_MAX];
    if (!dem__is_order_due(w)) return 1;
    const ptrdiff_t room = chunks > 1 ? n + n / 4 + (ptrdiff_t)chunks * (DEM__BLOCK + 1) : n;
    if (!dem__grow_contacts(w, room + 1) || !dem__fit_wall_forces(w, chunks)) {
        w->status = DEM_OUT_OF_MEMORY;
        return 0;
    }
    if (chunks > 1 && w->step % DEM__RANK_STEPS == 0) dem__renew_ranks(w);
    else if (dem__are_in_order(w)) return 1;
    dem__list_by_rank(w);
    dem__cut_chunks(w, chunks, run);
    dem__arrange(w, n, run, chunks, list, dem__kept_arrays(w, list));
    dem__list_wall_contacts(w);
    return 1;
}
