/* Lattice links that a surface cuts: the boundary law, the links of the solid at rest. */
#pragma once
#include "faces.h"

/* ==== >>links ==== */

/* A link from a fluid node along i to a solid. */
typedef struct filtration__cut {
    int x, y, z, i;
    double fraction; /* q [-] */
} filtration__cut;

/* Reads the outgoing population i of the node behind (against i). Returns 0 if that node is not fluid. */
static inline int filtration__behind(const filtration__lattice *l, const filtration__cut *k, double *h) {
    int p[3] = {k->x - l->c[k->i][0], k->y - l->c[k->i][1], k->z - l->c[k->i][2]}, mirrored;
    if (!filtration__inside(l, p, &mirrored) || l->owner[filtration__node(l, p[0], p[1], p[2])] != FILTRATION__FLUID)
        return 0;
    int i = mirrored ? filtration__turned(l, k->i, mirrored) : k->i;
    *h = filtration__get(l, filtration__outgoing(l, p[0], p[1], p[2], i));
    return 1;
}

/* Computes the population that returns along a link, and stores it where the next step reads it: by central linear interpolation (Ginzburg
   et al. 2008), or half way where there is no second fluid node. cu: c_i . velocity of the surface. Returns the outgoing population; *back:
   the returning one. */
static inline double filtration__bounce(filtration__lattice *l, const filtration__cut *k, double cu, double *back) {
    int opposite = filtration__opposite(k->i);
    double out = filtration__get(l, filtration__outgoing(l, k->x, k->y, k->z, k->i)), behind = 0.0;
    if (l->half_way || !filtration__behind(l, k, &behind)) {
        *back = out - 6.0 * l->w[k->i] * cu;
    } else {
        double other = filtration__get(l, filtration__outgoing(l, k->x, k->y, k->z, opposite));
        double weight = 1.0 / (1.0 + 2.0 * k->fraction);
        *back = out + (1.0 - 2.0 * k->fraction) * weight * (behind - other) - 12.0 * weight * l->w[k->i] * cu;
    }
    filtration__put(l, filtration__incoming(l, k->x, k->y, k->z, opposite), *back);
    return out;
}

/* The same at a node whose neighbours all lie in the box; place: of the node, node: its number. */
FILTRATION__INLINE double filtration__bounce_inner(filtration__lattice *l, ptrdiff_t place, ptrdiff_t node, int i,
                                                   double fraction, double cu, double *back) {
    const ptrdiff_t *at = l->out_at[l->odd];
    const int opposite = filtration__opposite(i);
    const double out = filtration__get(l, place + at[i]);
    if (l->half_way || l->owner[node - l->next_node[i]] != FILTRATION__FLUID) {
        *back = out - 6.0 * l->w[i] * cu;
    } else {
        const double behind = filtration__get(l, place - l->next_place[i] + at[i]),
                     other = filtration__get(l, place + at[opposite]);
        const double weight = 1.0 / (1.0 + 2.0 * fraction);
        *back = out + (1.0 - 2.0 * fraction) * weight * (behind - other) - 12.0 * weight * l->w[i] * cu;
    }
    filtration__put(l, place + l->in_at[l->odd][opposite], *back);
    return out;
}

static inline filtration__cut filtration__link_cut(const filtration__link *link) {
    filtration__cut k = {link->x, link->y, link->z, link->i, (double)link->fraction};
    return k;
}

FILTRATION__STATIC void filtration__link_task(void *context, int task) {
    filtration__lattice *l = (filtration__lattice *)context;
    ptrdiff_t first, end;
    double back;
    filtration__task_range(l->link_count, task, &first, &end);
    for (ptrdiff_t n = first; n < end; n++) {
        const filtration__link *link = &l->links[n];
        const ptrdiff_t node = filtration__node(l, link->x, link->y, link->z);
        if (l->owner[node] != FILTRATION__FLUID) continue;
        if (filtration__is_inner(l, link->x, link->y, link->z)) {
            const ptrdiff_t place = filtration__inner_place(l, link->x, link->y, link->z);
            filtration__bounce_inner(l, place, node, link->i, (double)link->fraction, 0.0, &back);
        } else {
            const filtration__cut k = filtration__link_cut(link);
            filtration__bounce(l, &k, 0.0, &back);
        }
    }
}

static inline void filtration__point(const filtration_fluid_def *def, int x, int y, int z, double point[3]) {
    point[0] = (x + 0.5) * def->voxel, point[1] = (y + 0.5) * def->voxel, point[2] = (z + 0.5) * def->voxel;
}

/* Returns whether the neighbour of a node along i belongs to the solid at rest; beyond walls and open faces there is none. */
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
