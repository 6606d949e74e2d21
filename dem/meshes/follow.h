/* Contacts of spheres with meshes. Each follows its place from step to step. */
#pragma once
#include "../search/narrow_phase.h"
#include "../walls/mesh.h"

DEM_INLINE dem__face_cache dem__face_cache_of(const dem_world *w, ptrdiff_t c) {
    double *const *place = w->engine->contacts.touch;
    dem__face_cache f;
    f.at = dem__place_vec(w, DEM__PLACE_CACHE, c);
    f.slack = place[DEM__PLACE_SLACK][c], f.face = (int32_t)place[DEM__PLACE_FACE][c];
    return f;
}
DEM_INLINE void dem__set_face_cache(dem_world *w, ptrdiff_t c, const dem__face_cache *f) {
    double *const *place = w->engine->contacts.touch;
    dem__set_place_vec(w, DEM__PLACE_CACHE, c, f->at);
    place[DEM__PLACE_SLACK][c] = f->slack, place[DEM__PLACE_FACE][c] = (double)f->face;
}

/* Lists the contacts of particle i with wall k in the order of elements. Returns how many, at most DEM__NUMBERS. */
DEM_INLINE int dem__contacts_at(const dem_world *w, ptrdiff_t i, int k, int32_t *slot) {
    const dem__contacts *contacts = &w->engine->contacts;
    int n = 0;
    for (int32_t c = w->engine->walls.first_contact[i]; c >= 0 && n < DEM__NUMBERS; c = contacts->wall_next[c]) {
        if (contacts->j[c] != -1 - k) continue;
        int q = n++;
        for (; q > 0 && contacts->element[slot[q - 1]] > contacts->element[c]; q--) slot[q] = slot[q - 1];
        slot[q] = c;
    }
    return n;
}

/* Where particle i touches mesh k. */
typedef struct dem__mesh_places {
    dem__touch touch[DEM__TOUCHES];
    int n, taken, used; /* number of places; bits: places that have a contact, elements of the contacts */
} dem__mesh_places;

/* Moves the contacts of particle i with mesh k, in the listed slots, to a step to which the wall has been moved. Each
   continues at the deepest place whose normal is close to its own, or ends. Returns the places; none if the only
   contact still rests on its cached face. */
static inline void dem__match_places(dem_world *w, ptrdiff_t i, int k, const int32_t *slot, int slots, int64_t step,
                                     dem__mesh_places *at) {
    dem__contacts *contacts = &w->engine->contacts;
    const dem_wall *wall = &w->wall[k];
    const double tau = (double)(step - w->particle[i].origin) * w->engine->run.dt;
    const dem_vec x = dem__at(w, i, tau), d = dem__sub(x, wall->position);
    const double speed =
        dem__length(dem__velocity_at(w, i, tau)) + wall->speed_bound + wall->spin_bound * dem__arm(wall, x);
    const double radius = w->particle[i].radius, near = w->engine->pairs.touch_gap,
                 leaves = 2.0 * w->engine->run.dt * speed, /* more than a contact can open in a step */
        deep = leaves > near ? leaves : near;
    dem__face_cache cache = dem__face_cache_of(w, slot[0]);
    double least;
    at->n = at->taken = at->used = 0;
    if (slots == 1 && dem__face_cache_holds(wall, &cache, d, radius, deep, at->touch)) {
        dem__set_touch(w, slot[0], at->touch);
        return;
    }
    at->n = dem__touch_mesh(wall, d, radius, deep, radius, at->touch, &least);
    for (int m = 0; m < slots; m++) {
        const int32_t c = slot[m];
        int q = 0;
        at->used |= 1 << contacts->element[c];
        while (q < at->n &&
               ((at->taken >> q & 1) || !(dem__dot(at->touch[q].normal, dem__place_normal(w, c)) > DEM__SMOOTH)))
            q++;
        if (q == at->n) { /* merged with another: it ends without a force, whatever its depth */
            contacts->touch[DEM__PLACE_GAP][c] = w->particle[i].radius;
            contacts->force[c] = 0.0;
            continue;
        }
        at->taken |= 1 << q;
        dem__set_touch(w, c, &at->touch[q]);
    }
    cache.slack = 0.0;
    if (slots == 1 && at->n == 1 && at->taken) cache = dem__find_face_cache(wall, d, radius, at->touch);
    for (int m = 0; m < slots; m++) dem__set_face_cache(w, slot[m], &cache);
}

/* Returns whether place q touches and has no contact. */
DEM_INLINE int dem__is_place_left(const dem__mesh_places *at, int q) {
    return !(at->taken >> q & 1) && at->touch[q].gap < 0.0;
}
static inline int dem__are_places_left(const dem__mesh_places *at) {
    for (int q = 0; q < at->n; q++) {
        if (dem__is_place_left(at, q)) return 1;
    }
    return 0;
}

/* Begins contacts of particle i with mesh k at the remaining places, as long as there are free elements. */
static inline void dem__begin_at_places(dem_world *w, ptrdiff_t i, int k, dem__mesh_places *at) {
    for (int q = 0; q < at->n; q++) {
        int32_t element = 0;
        if (!dem__is_place_left(at, q)) continue;
        while (at->used >> element & 1) element++;
        if (element == DEM__NUMBERS) return;
        at->used |= 1 << element;
        if (!dem__new_wall_contact(w, i, k, &at->touch[q], element)) return;
    }
}

/* Lists the contacts of a particle with a mesh if slot c holds the first of them. Returns how many, otherwise 0. */
static inline int dem__contacts_at_mesh(const dem_world *w, ptrdiff_t c, int32_t *slot) {
    const int k = -1 - (int)w->engine->contacts.j[c];
    if (k < 0 || !dem__has(&w->wall[k], DEM__TRIANGULATED) || dem__is_convex_contact(w, c))
        return 0; /* the contacts of a polyhedron follow its points */
    const int slots = dem__contacts_at(w, w->engine->contacts.i[c], k, slot);
    return slots > 0 && slot[0] == c ? slots : 0;
}

/* Moves the contacts of chunks first .. end-1. Marks in contacts.partial, which the kernel has not written yet, where
   places remain: contacts begin on one thread. */
static inline void dem__find_followers(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *step) {
    dem__contacts *contacts = &w->engine->contacts;
    (void)part;
    for (const dem__chunk *in = contacts->chunk + first; in < contacts->chunk + end; in++) {
        for (ptrdiff_t c = in->first; c < in->first + in->count; c++) {
            int32_t slot[DEM__NUMBERS];
            dem__mesh_places at;
            const int slots = dem__contacts_at_mesh(w, c, slot);
            contacts->partial[c] = 0;
            if (slots == 0) continue;
            for (int m = 0; m < slots; m++)
                dem__set_place_vec(w, DEM__PLACE_BEFORE, slot[m], dem__place_normal(w, slot[m]));
            dem__match_places(w, contacts->i[c], -1 - (int)contacts->j[c], slot, slots, *(const int64_t *)step, &at);
            contacts->partial[c] = (uint8_t)dem__are_places_left(&at);
        }
    }
}

/* Moves contacts with meshes to a step to which the walls have been moved, and begins contacts at other places of
   meshes that particles already touch. */
static inline void dem__follow_meshes(dem_world *w, int64_t step) {
    const dem__contacts *contacts = &w->engine->contacts;
    const ptrdiff_t end = dem__next_slot(w);
    dem__in_parts(w, dem__parts_of(w, contacts->count, contacts->chunk_count), contacts->chunk_count,
                  dem__find_followers, &step);
    DEM__EACH_CONTACT(w, c) {
        int32_t slot[DEM__NUMBERS];
        dem__mesh_places at;
        if (c >= end || !contacts->partial[c] || w->status != DEM_OK) continue;
        const ptrdiff_t i = contacts->i[c];
        const int k = -1 - (int)contacts->j[c], slots = dem__contacts_at_mesh(w, c, slot);
        dem__match_places(w, i, k, slot, slots, step, &at);
        dem__begin_at_places(w, i, k, &at);
    }
}
