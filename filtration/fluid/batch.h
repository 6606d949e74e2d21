/* Links in batches: their data are gathered, computed for many links at a time, and stored. */
#pragma once
#include "faces.h"

/* ==== >>batch ==== */

#define FILTRATION__BATCH 64 /* links after which a batch is applied, a multiple of FILTRATION__LANES */
#define FILTRATION__ROOM (2 * FILTRATION__BATCH) /* what it can hold */
#define FILTRATION__LANES                                                                                              \
    8 /* parts of a sum, added in their order at the end, so that bits do not depend on the width of vectors */

/* Links from fluid nodes to a surface. */
typedef struct filtration__batch {
    int n;
    ptrdiff_t place[FILTRATION__ROOM]; /* of the node; later where the next step reads the returning population */
    double out[FILTRATION__ROOM], other[FILTRATION__ROOM]; /* population that leaves the node along the link, and
                                                              against it */
    double behind[FILTRATION__ROOM],
        free[FILTRATION__ROOM];    /* population that leaves the node behind along the link, if that is fluid (1, else
                                      0) */
    double back[FILTRATION__ROOM]; /* what returns */
    double d[3][FILTRATION__ROOM]; /* from the centre to the fluid node, then to the surface */
    double fraction[FILTRATION__ROOM],
        push[FILTRATION__ROOM]; /* q; weight times c . velocity of the surface, c into the solid */
    double w[FILTRATION__ROOM]; /* weight; 0: nothing is added */
} filtration__batch;

/* Where the populations of links along one direction are, relative to the node, whose neighbours all lie in the box. */
typedef struct filtration__paths {
    ptrdiff_t out, other, behind, in, node_behind;
} filtration__paths;

/* i: from the fluid node to the surface. */
static inline filtration__paths filtration__paths_of(const filtration__lattice *l, int i) {
    const ptrdiff_t *out = l->out_at[l->odd];
    const int opposite = filtration__opposite(i);
    const filtration__paths p = {out[i], out[opposite], out[i] - l->next_place[i], l->in_at[l->odd][opposite],
                                 -l->next_node[i]};
    return p;
}

/* Reads the populations of links of such nodes along one direction. Their places become those of the returning
   populations. */
FILTRATION__INLINE void filtration__read_batch(const filtration__lattice *l, filtration__batch *b,
                                               const filtration__paths *path) {
    for (int k = 0; k < b->n; k++) {
        const ptrdiff_t place = b->place[k], behind = place + (b->free[k] > 0.0 ? path->behind : path->out);
        b->place[k] = place + path->in;
        b->out[k] = filtration__get(l, place + path->out), b->other[k] = filtration__get(l, place + path->other);
        b->behind[k] = filtration__get(l, behind);
    }
}

/* Adds the link from any fluid node p along i, and reads its populations. */
static inline void filtration__gather_link(const filtration__lattice *l, filtration__batch *b, const int p[3], int i) {
    const int k = b->n++, opposite = filtration__opposite(i);
    int mirrored, at[3] = {p[0] - l->c[i][0], p[1] - l->c[i][1], p[2] - l->c[i][2]};
    b->place[k] = filtration__incoming(l, p[0], p[1], p[2], opposite), b->free[k] = b->behind[k] = 0.0;
    b->out[k] = filtration__get(l, filtration__outgoing(l, p[0], p[1], p[2], i));
    b->other[k] = filtration__get(l, filtration__outgoing(l, p[0], p[1], p[2], opposite));
    if (l->half_way || !filtration__inside(l, at, &mirrored) ||
        l->owner[filtration__node(l, at[0], at[1], at[2])] != FILTRATION__FLUID)
        return;
    b->free[k] = 1.0;
    b->behind[k] = filtration__get(
        l, filtration__outgoing(l, at[0], at[1], at[2], mirrored ? filtration__turned(l, i, mirrored) : i));
}

/* Fills a batch to whole lanes with links that add nothing. */
static inline int filtration__pad_batch(filtration__batch *b) {
    int end = b->n;
    for (; end % FILTRATION__LANES; end++) {
        b->free[end] = b->w[end] = b->fraction[end] = b->push[end] = b->out[end] = b->behind[end] = b->other[end] = 0.0;
        for (int a = 0; a < 3; a++) b->d[a][end] = 0.0;
    }
    return end;
}

/* Stores the returning populations where the next step reads them. */
FILTRATION__INLINE void filtration__write_batch(filtration__lattice *l, const filtration__batch *b) {
    if (l->single)
        for (int k = 0; k < b->n; k++) ((float *)l->f)[b->place[k]] = (float)b->back[k];
    else
        for (int k = 0; k < b->n; k++) ((double *)l->f)[b->place[k]] = b->back[k];
}

/* Computes the returning populations: by central linear interpolation (Ginzburg et al. 2008), or half way where there
   is no second fluid node. end: a multiple of FILTRATION__LANES. */
FILTRATION__INLINE void filtration__bounce_lanes(filtration__batch *b, int end) {
    for (int k = 0; k < end; k++) {
        const double q = b->fraction[k], weight = 1.0 / (1.0 + 2.0 * q), push = b->push[k];
        const double linear =
            b->out[k] + (1.0 - 2.0 * q) * weight * (b->behind[k] - b->other[k]) - 12.0 * weight * push;
        b->back[k] = b->free[k] > 0.0 ? linear : b->out[k] - 6.0 * push;
    }
}
FILTRATION__CLONES(filtration__bounce_batch, (filtration__batch * b, int end), (b, end),
                   filtration__bounce_lanes(b, end))
