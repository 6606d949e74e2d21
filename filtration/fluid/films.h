/* Pressure in films that are too thin for nodes, between spheres, at the solid and at faces; the force on the solid at
   rest. A constant added to the pressure changes no force. */
#pragma once
#include "spheres.h"

/* ==== >>films ==== */

/* Adds the pressure on a link between two solids, or through a face, from node (x, y, z) of the sphere along j. Both
   spheres get the mean of the densities that each would have there, so that the film pushes them apart with equal
   forces. */
static inline void filtration__film_link(filtration__lattice *l, int32_t index, filtration__ball *b, int x, int y,
                                         int z, int j) {
    const int n[3] = {l->nx, l->ny, l->nz};
    int s[3] = {x, y, z}, p[3] = {x + l->c[j][0], y + l->c[j][1], z + l->c[j][2]}, mirrored;
    double d[3];
    for (int a = 0; a < 3; a++) d[a] = s[a] + 0.5 * l->c[j][a] - b->centre[a];
    if (!filtration__inside(l, s, &mirrored) || mirrored || l->owner[filtration__node(l, s[0], s[1], s[2])] != index)
        return;
    double density = filtration__density_at(b, d);
    if (filtration__inside(l, p, &mirrored)) {
        const int32_t owner = l->owner[filtration__node(l, p[0], p[1], p[2])];
        if (mirrored || owner == FILTRATION__FLUID) return;
        if (owner >= 0) {
            const filtration__ball *other = &l->balls[owner];
            double away[3];
            for (int a = 0; a < 3; a++) {
                away[a] = p[a] - other->centre[a];
                if (filtration__repeats(l, a)) away[a] -= n[a] * floor(away[a] / n[a] + 0.5);
                away[a] -= 0.5 * l->c[j][a];
            }
            density = 0.5 * (density + filtration__density_at(other, away));
        }
    }
    for (int a = 0; a < 3; a++) {
        b->force[0][a] -= 2.0 * l->w[j] * l->c[j][a] * density;
        b->hull[a] -= l->c[j][a] * l->whole_weight[j];
    }
}

FILTRATION__INLINE void filtration__film_part(filtration__lattice *l, int32_t index, filtration__ball *b,
                                              filtration__visit *none, const filtration__run *r, int j, int inner,
                                              int first, int end) {
    (void)none, (void)inner;
    for (int x = first; x <= end; x++) filtration__film_link(l, index, b, x, r->y, r->z, j);
}

/* Adds the pressure of films. Links that leave the surface open (mirrors, spheres that overlap) get the density at the
   centre, so that a constant pressure moves no sphere. */
FILTRATION__STATIC void filtration__film_task(void *context, int task) {
    filtration__lattice *l = (filtration__lattice *)context;
    for (ptrdiff_t n = task; n < l->ball_count; n += FILTRATION__TASKS) {
        filtration__ball *b = &l->balls[n];
        if (!(b->radius > 0.0)) continue;
        if (b->films) filtration__ball_links(l, (int32_t)n, b, NULL, filtration__film_part);
        for (int a = 0; a < 3; a++) b->force[0][a] -= 2.0 / 72.0 * (double)b->hull[a] * b->density;
        filtration__lubricate(l, n, (1.0 / l->rates.plus - 0.5) / 3.0);
    }
}

/* Computes the force of the last step on the solid at rest, in lattice units: the momentum exchanged over its links
   (Ladd 1994), and the pressure of films under spheres. */
static inline void filtration__solid_force(const filtration__lattice *l, double force[3]) {
    force[0] = force[1] = force[2] = 0.0;
    for (ptrdiff_t n = 0; n < l->link_count; n++) {
        const filtration__cut k = filtration__link_cut(&l->links[n]);
        const int at[3] = {k.x, k.y, k.z}, size[3] = {l->nx, l->ny, l->nz};
        const int32_t owner = l->owner[filtration__node(l, k.x, k.y, k.z)];
        double h, d[3];
        if (owner == FILTRATION__FLUID) {
            h = filtration__get(l, filtration__outgoing(l, k.x, k.y, k.z, k.i)) +
                filtration__get(l, filtration__incoming(l, k.x, k.y, k.z, filtration__opposite(k.i)));
        } else if (owner >= 0) {
            const filtration__ball *b = &l->balls[owner];
            for (int a = 0; a < 3; a++) {
                d[a] = at[a] - b->centre[a];
                if (filtration__repeats(l, a)) d[a] -= size[a] * floor(d[a] / size[a] + 0.5);
                d[a] += 0.5 * l->c[k.i][a];
            }
            h = 2.0 * l->w[k.i] * filtration__density_at(b, d);
        } else {
            continue;
        }
        for (int a = 0; a < 3; a++) force[a] += l->c[k.i][a] * h;
    }
}
