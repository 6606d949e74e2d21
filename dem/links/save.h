/* Links in a saved world. */
#pragma once
#include "../records/groups.h"
#include "list.h"
#include "work.h"

static inline void dem__link_fields(dem_world *w, dem__group *g) {
    dem__links *links = &w->engine->links;
    const dem__saved_field fields[] = {
        DEM__INTEGER("link.i", links->i[0], sizeof *links->i),
        DEM__INTEGER("link.j", links->j[0], sizeof *links->j),
        DEM__INTEGER("link.element", links->element[0], sizeof *links->element),
    };
    dem__set_fields(g, fields, sizeof fields, 3);
    dem__add_fields(g, "link.state", links->state, links->states);
    g->needed = g->fields;
}

static inline void dem__world_fields_of_links(dem_world *w, dem__group *g) {
    dem__links *links = &w->engine->links;
    const dem__saved_field fields[] = {
        DEM__INTEGER("link.on", links->on, 0),     DEM__INTEGER("link.states", links->states, 0),
        DEM__INTEGER("link.law", links->mark, 0),  DEM__DOUBLES("link.interval", links->interval, 0),
        DEM__DOUBLES("link.near", links->near, 0),
    };
    dem__add_optional(g, fields, sizeof fields);
}

static inline void dem__particle_fields_of_links(dem_world *w, dem__group *g) {
    dem__links *links = &w->engine->links;
    const dem__saved_field fields[] = {
        DEM__INTEGER("particle.is_loaded", links->is_loaded[0], sizeof *links->is_loaded),
        DEM__DOUBLES("particle.evaluated_at", links->evaluated_at[0], sizeof *links->evaluated_at),
    };
    dem__add_optional(g, fields, sizeof fields);
}

static inline void dem__save_links(dem__stream *s, dem_world *w, dem__group *g) {
    if (w->engine->links.count == 0) return;
    dem__link_fields(w, g);
    dem__write_group(s, w, g, w->engine->links.count, 2);
}

static inline int dem__has_links(const dem__file *file, const dem_world *w) {
    const dem__links *links = &w->engine->links;
    if (!dem__is_flag(links->on) || links->states < 0 || links->states > DEM_STATE_MAX) return -1;
    if (!dem__not_negative(links->near) || !dem__not_negative(links->interval)) return -1;
    if (links->on ? !dem__positive(links->interval) : dem__entries_of(file, "link.i") > 0) return -1;
    return links->on;
}

static inline dem_status dem__load_links(const dem__file *file, dem_world *w, dem__group *g) {
    dem__links *links = &w->engine->links;
    dem__array list[DEM__ARRAYS_MAX];
    const ptrdiff_t n = dem__entries_of(file, "link.i");
    if (n == 0) return DEM_OK;
    if (!dem__grow_group(w, list, dem__link_arrays(w, list), &links->block, &links->bytes, &links->capacity, n))
        return DEM_OUT_OF_MEMORY;
    dem__link_fields(w, g);
    if (!dem__read_group(file, g, n)) return DEM_BAD_DATA;
    for (links->count = 0; links->count < n; links->count++) {
        if (!dem__are_bodies(w, links->i[links->count], links->j[links->count])) return DEM_BAD_DATA;
    }
    return DEM_OK;
}

static inline void dem__derive_links(dem_world *w) {
    w->engine->pairs.touch_gap = w->engine->links.near;
    dem__set_link_steps(w);
    dem__find_links(w);
}

static inline void dem__hash_linked(uint64_t *hash, const dem_world *w, ptrdiff_t i) {
    dem__hash_f64(hash, w->engine->bodies.external[i], 6);
    dem__hash_i64(hash, w->engine->links.is_loaded[i]);
}

static inline void dem__hash_links(uint64_t *hash, const dem_world *w) {
    const dem__links *links = &w->engine->links;
    for (ptrdiff_t k = 0; k < links->count; k++) {
        dem__hash_bodies(hash, w, links->i[k], links->j[k], links->element[k]);
        for (int a = 0; a < links->states; a++) dem__hash_f64(hash, &links->state[a][k], 1);
    }
}
