/* The links of each particle, in lists. A link is in the lists of both of its bodies. */
#pragma once
#include "../removal/remove.h"

/* Lists the arrays of links. Returns how many. */
static inline int dem__link_arrays(dem_world *w, dem__array *list) {
    dem__links *links = &w->engine->links;
    int n = 0;
    int32_t **integers[] = {&links->i, &links->j, &links->element, &links->next_i, &links->next_j};
    for (size_t k = 0; k < sizeof integers / sizeof *integers; k++, n++)
        list[n].address = integers[k], list[n].size = sizeof(int32_t);
    for (int k = 0; k < links->states; k++, n++) list[n].address = &links->state[k], list[n].size = sizeof(double);
    for (int k = 0; k < 9; k++, n++) list[n].address = &links->wrench[k], list[n].size = sizeof(double);
    list[n].address = &links->gap, list[n++].size = sizeof(double);
    list[n].address = &links->ended, list[n++].size = 1;
    return n;
}

/* Returns the link after k in particle i's list; -1 at its end. */
DEM_INLINE int32_t dem__next_link(const dem_world *w, int32_t k, ptrdiff_t i) {
    const dem__links *links = &w->engine->links;
    return links->i[k] == i ? links->next_i[k] : links->next_j[k];
}

/* Returns the link of particle i with body j (a wall: -1 - index) at one of its elements, or -1. */
static inline int32_t dem__link_of(const dem_world *w, ptrdiff_t i, ptrdiff_t j, int32_t element) {
    const dem__links *links = &w->engine->links;
    int32_t k = links->first_link[i];
    while (k >= 0) {
        const int first = links->i[k] == i;
        if ((first ? links->j[k] : links->i[k]) == j && (j >= 0 || links->element[k] == element)) return k;
        k = dem__next_link(w, k, i);
    }
    return -1;
}

/* Sets the distance at which near pair p is in contact, which is larger for linked particles. p = -1: does nothing. */
DEM_INLINE void dem__mark_link(dem_world *w, int32_t p, int linked) {
    if (p < 0) return;
    dem__near *q = &w->engine->pairs.near[p];
    q->distance = w->particle[q->i].radius + w->particle[q->j].radius + (linked ? w->engine->links.near : 0.0);
}

DEM_INLINE void dem__list_link(dem_world *w, int32_t k) {
    dem__links *links = &w->engine->links;
    const int32_t i = links->i[k], j = links->j[k];
    links->next_i[k] = links->first_link[i];
    links->first_link[i] = k;
    if (j < 0) return;
    const int32_t p = dem__near_pair(w, i, j);
    links->next_j[k] = links->first_link[j];
    links->first_link[j] = k;
    dem__mark_link(w, p, 1);
}

static inline void dem__find_links(dem_world *w) {
    for (ptrdiff_t i = 0; i < w->count; i++) w->engine->links.first_link[i] = -1;
    for (int32_t k = 0; k < (int32_t)w->engine->links.count; k++) dem__list_link(w, k);
}

/* Removes link k from particle i's list, or puts another link in its place. */
static inline void dem__unlist_link(dem_world *w, int32_t k, int32_t i, int32_t replacement) {
    dem__links *links = &w->engine->links;
    int32_t *at = &links->first_link[i];
    while (*at != k) at = links->i[*at] == i ? &links->next_i[*at] : &links->next_j[*at];
    *at = replacement >= 0 ? replacement : dem__next_link(w, k, i);
}

/* Returns the highest slot of a particle's links, because the order of its list depends on the history of the scene. */
static inline int32_t dem__last_link(const dem_world *w, ptrdiff_t i) {
    int32_t last = -1;
    for (int32_t k = w->engine->links.first_link[i]; k >= 0; k = dem__next_link(w, k, i)) last = k > last ? k : last;
    return last;
}

/* Ends link k; the last link takes its slot. Its force acts until links are evaluated again. */
static inline void dem__cut_link(dem_world *w, int32_t k) {
    const int32_t i = w->engine->links.i[k], j = w->engine->links.j[k], last = (int32_t)w->engine->links.count - 1;
    dem__report_end(w, w->engine->links.law, k);
    dem__unlist_link(w, k, i, -1);
    if (j >= 0) {
        const int32_t p = dem__near_pair(w, i, j);
        dem__mark_link(w, p, 0);
        dem__unlist_link(w, k, j, -1);
    }
    w->engine->links.count = last;
    if (k == last) return;
    dem__unlist_link(w, last, w->engine->links.i[last], k);
    if (w->engine->links.j[last] >= 0) dem__unlist_link(w, last, w->engine->links.j[last], k);
    dem__array list[DEM__ARRAYS_MAX];
    const int n = dem__link_arrays(w, list);
    for (int a = 0; a < n; a++) {
        char *base;
        memcpy(&base, list[a].address, sizeof base);
        memcpy(base + (size_t)k * list[a].size, base + (size_t)last * list[a].size, list[a].size);
    }
}
