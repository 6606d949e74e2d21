/* Forces between particles and the vectors along which they act, from which a stress is computed. */
#pragma once
#include "../base/measure_api.h"
#include "getters.h"

/* Return how many forces act between particles, and one of them. Contacts come first, then the forces of features. */
static inline ptrdiff_t dem__forces(const dem_world *w) {
    ptrdiff_t n = w->engine->contacts.count;
    DEM__ADD_UP(w, n, forces, (w));
    return n;
}
static inline dem_contact_info dem__get_force(const dem_world *w, ptrdiff_t k) {
    const dem__feature *f = w->engine->feature;
    if (k < w->engine->contacts.count) return dem_get_contact(w, k);
    for (k -= w->engine->contacts.count; !f->forces || k >= f->forces(w); f++) {
        if (f->forces) k -= f->forces(w);
    }
    return f->force(w, k);
}

/* Finds the branch vector of a contact or, from k = contacts on, of a link. It leads from the partner's centre, or the
   point on a wall, to the centre of i; for bodies, between centres of mass. Returns 0 if it carries no force. */
static inline int dem__branch(const dem_world *w, ptrdiff_t k, dem_vec *from, dem_vec *to, dem_vec *force) {
    const dem__contacts *contacts = &w->engine->contacts;
    const dem_contact_info c = dem__get_force(w, k);
    *to = dem_position(w, c.i);
    *force = c.force;
    if (c.j >= 0) *from = dem__sub(*to, dem__nearest_image(w, dem__sub(*to, dem_position(w, c.j))));
    else if (k < contacts->count && dem__shape_of(w, c.i)) {
        const ptrdiff_t slot = dem__slot_of(w, k);
        *from = dem__add(
            *to, dem__plus(dem__place_arm(w, slot), -dem__touching_radius(w, c.i) - c.gap, dem__place_normal(w, slot)));
    } else {
        dem__touch touch;
        dem__touch_place(w, k < contacts->count ? dem__slot_of(w, k) : -1, &w->wall[-1 - c.j], *to,
                         w->particle[c.i].radius, c.element, &touch);
        *from = dem__sub(*to, dem__scale(w->particle[c.i].radius + touch.gap, touch.normal));
    }
    *to = dem__sub(*to, dem__arm_now(w, c.i));
    if (c.j >= 0) *from = dem__sub(*from, dem__arm_now(w, c.j));
    return dem__dot(c.force, c.force) > 0.0;
}
