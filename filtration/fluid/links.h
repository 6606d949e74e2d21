/* Lattice links that the surface of the solid at rest cuts. */
#pragma once
#include "batch.h"

/* ==== >>links ==== */

/* A link from a fluid node along i to a solid. */
typedef struct filtration__cut {
    int x, y, z, i;
    double fraction; /* q [-] */
} filtration__cut;

static inline filtration__cut filtration__link_cut(const filtration__link *link) {
    filtration__cut k = {link->x, link->y, link->z, link->i, (double)link->fraction};
    return k;
}

static inline void filtration__bounce_links(filtration__lattice *l, filtration__batch *b) {
    if (b->n == 0) return;
    filtration__bounce_batch(b, filtration__pad_batch(b));
    filtration__write_batch(l, b);
    b->n = 0;
}

FILTRATION__STATIC void filtration__link_task(void *context, int task) {
    filtration__lattice *l = (filtration__lattice *)context;
    filtration__batch b;
    filtration__paths path[FILTRATION__Q];
    ptrdiff_t first, end;
    for (int i = 0; i < l->q; i++) path[i] = filtration__paths_of(l, i);
    filtration__task_range(l->link_count, task, &first, &end);
    b.n = 0;
    for (ptrdiff_t n = first; n < end; n++) {
        const filtration__link *link = &l->links[n];
        const int p[3] = {link->x, link->y, link->z}, i = link->i;
        const ptrdiff_t node = filtration__node(l, p[0], p[1], p[2]);
        if (l->owner[node] != FILTRATION__FLUID) continue;
        b.fraction[b.n] = (double)link->fraction, b.push[b.n] = 0.0;
        if (filtration__is_inner(l, p[0], p[1], p[2])) {
            const ptrdiff_t place = filtration__inner_place(l, p[0], p[1], p[2]);
            const int k = b.n++, is_free = l->owner[node + path[i].node_behind] == FILTRATION__FLUID && !l->half_way;
            b.free[k] = is_free ? 1.0 : 0.0, b.place[k] = place + path[i].in;
            b.out[k] = filtration__get(l, place + path[i].out), b.other[k] = filtration__get(l, place + path[i].other);
            b.behind[k] = is_free ? filtration__get(l, place + path[i].behind) : 0.0;
        } else {
            filtration__gather_link(l, &b, p, i);
        }
        if (b.n == FILTRATION__BATCH) filtration__bounce_links(l, &b);
    }
    filtration__bounce_links(l, &b);
}

static inline void filtration__point(const filtration_fluid_def *def, int x, int y, int z, double point[3]) {
    point[0] = (x + 0.5) * def->voxel, point[1] = (y + 0.5) * def->voxel, point[2] = (z + 0.5) * def->voxel;
}

/* Returns whether the neighbour of a node along i belongs to the solid at rest; beyond walls and open faces there is
   none. */
static inline int filtration__meets_solid(const filtration__lattice *l, int x, int y, int z, int i) {
    int p[3] = {x + l->c[i][0], y + l->c[i][1], z + l->c[i][2]}, mirrored;
    return filtration__inside(l, p, &mirrored) && l->owner[filtration__node(l, p[0], p[1], p[2])] == FILTRATION__SOLID;
}

static inline double filtration__solid_fraction(const filtration_fluid_def *def, const filtration__lattice *l, int x,
                                                int y, int z, int i) {
    double a[3], b[3], q = 0.5;
    filtration__point(def, x, y, z, a);
    filtration__point(def, x + l->c[i][0], y + l->c[i][1], z + l->c[i][2], b);
    if (def->boundary == FILTRATION_CENTRAL_LINEAR)
        q = def->solid.cut ? def->solid.cut(def->solid.self, a, b) : filtration_solid_cut(&def->solid, a, b);
    return q >= 0.0 && q <= 1.0 ? q : 0.5;
}

/* Lists the links of the solid. Called twice: first only to count them (links NULL). */
static inline void filtration__list_links(const filtration_fluid_def *def, filtration__lattice *l) {
    l->link_count = 0;
    for (int z = 0; z < l->nz; z++)
        for (int y = 0; y < l->ny; y++)
            for (int x = 0; x < l->nx; x++) {
                if (l->owner[filtration__node(l, x, y, z)] == FILTRATION__SOLID) continue;
                for (int i = 1; i < l->q; i++) {
                    if (!filtration__meets_solid(l, x, y, z, i)) continue;
                    if (l->links) {
                        filtration__link link = {x, y, z, i, (float)filtration__solid_fraction(def, l, x, y, z, i)};
                        l->links[l->link_count] = link;
                    }
                    l->link_count++;
                }
            }
}

/* Marks the nodes of the solid, and the rows that are all solid. */
static inline void filtration__mark_solid(const filtration_fluid_def *def, filtration__lattice *l) {
    for (int z = 0; z < l->nz; z++)
        for (int y = 0; y < l->ny; y++) {
            int solid = 0;
            for (int x = 0; x < l->nx; x++) {
                double point[3];
                filtration__point(def, x, y, z, point);
                if (def->solid.distance(def->solid.self, point) > 0.0) continue;
                l->owner[filtration__node(l, x, y, z)] = FILTRATION__SOLID;
                solid++;
            }
            l->fluid_nodes -= solid;
            l->solid_nodes += solid;
            if (solid == l->nx) l->row_state[(ptrdiff_t)z * l->ny + y] = FILTRATION__ROW_SOLID;
        }
}
