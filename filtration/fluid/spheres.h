/* Moving spheres on the lattice: the nodes that they cover, their links, the force on them, nodes that they leave. */
#pragma once
#include "links.h"
#include "near.h"

/* ==== >>spheres ==== */

/* Finds the nodes first .. end of the row at (y, z) inside a sphere; first > end: none. */
static inline void filtration__chord(const filtration__ball *b, int y, int z, int *first, int *end) {
    double dy = y - b->centre[1], dz = z - b->centre[2], rest = b->radius * b->radius - (dy * dy + dz * dz);
    *first = 1, *end = 0;
    if (!(rest > 0.0)) return;
    const double half = sqrt(rest), low = b->centre[0] - half, high = b->centre[0] + half;
    const int a = (int)low, e = (int)high; /* floor and ceil are calls on some machines */
    *first = a - (a > low) + 1, *end = e + (e < high) - 1;
}

/* Finds the rows that a sphere may cover along an axis. */
static inline void filtration__extent(const filtration__ball *b, int axis, int *first, int *end) {
    *first = (int)ceil(b->centre[axis] - b->radius);
    *end = (int)floor(b->centre[axis] + b->radius);
}

/* Returns the index of another sphere that covers the node at p (within the box), or FILTRATION__FRESH. */
static inline int32_t filtration__cover(const filtration__lattice *l, const int p[3], ptrdiff_t not_this) {
    const int n[3] = {l->nx, l->ny, l->nz};
    for (ptrdiff_t k = 0; k < l->ball_count; k++) {
        const filtration__ball *b = &l->balls[k];
        if (k == not_this || !(b->radius > 0.0)) continue;
        double rr = 0.0;
        for (int a = 0; a < 3; a++) {
            double d = p[a] - b->centre[a];
            if (filtration__repeats(l, a)) d -= n[a] * floor(d / n[a] + 0.5);
            rr += d * d;
        }
        if (rr < b->radius * b->radius) return (int32_t)k;
    }
    return FILTRATION__FRESH;
}

/* Makes `index` the owner of nodes that are inside `now` and not inside `before` (NULL: nothing). With leave 1, and
   both exchanged, the sphere leaves such nodes. */
static inline void filtration__swap_nodes(filtration__lattice *l, ptrdiff_t index, const filtration__ball *now,
                                          const filtration__ball *before, int leave) {
    int y0, y1, z0, z1, mirrored;
    filtration__extent(now, 1, &y0, &y1);
    filtration__extent(now, 2, &z0, &z1);
    for (int z = z0; z <= z1; z++)
        for (int y = y0; y <= y1; y++) {
            int a, b, from = 1, to = 0;
            filtration__chord(now, y, z, &a, &b);
            if (before) filtration__chord(before, y, z, &from, &to);
            for (int x = a; x <= b; x++) {
                if (x >= from && x <= to) x = to + 1;
                if (x > b) break;
                int p[3] = {x, y, z};
                if (!filtration__inside(l, p, &mirrored) || mirrored) continue;
                int32_t *owner = &l->owner[filtration__node(l, p[0], p[1], p[2])];
                if (leave && *owner == (int32_t)index) *owner = filtration__cover(l, p, index), l->left = 1;
                if (!leave && (*owner == FILTRATION__FLUID || *owner == FILTRATION__FRESH)) *owner = (int32_t)index;
            }
        }
}

/* Computes the velocity of a sphere, on its surface or inside, at a point relative to its centre. */
static inline void filtration__surface_velocity(const filtration__ball *b, const double d[3], double u[3]) {
    u[0] = b->velocity[0] + b->spin[1] * d[2] - b->spin[2] * d[1];
    u[1] = b->velocity[1] + b->spin[2] * d[0] - b->spin[0] * d[2];
    u[2] = b->velocity[2] + b->spin[0] * d[1] - b->spin[1] * d[0];
}

/* Sums over the links of a sphere, weighted as the lattice is: of the density at its surface and of places, for a line
   fitted to it. */
typedef struct filtration__surface {
    double weight, density, place[3], rise[3]; /* sums of w, w r, w d, w r d */
    double spread[6];                          /* of w d d: xx, yy, zz, yz, zx, xy */
    double arm[3];                             /* of w (d x c), c into the fluid */
    double force[3], torque[3];
} filtration__surface;
enum { FILTRATION__SUMS = sizeof(filtration__surface) / sizeof(double) };

/* A sphere while its links are visited. */
typedef struct filtration__visit {
    double part[FILTRATION__SUMS][FILTRATION__LANES]; /* of filtration__surface, in its order */
    double push[FILTRATION__NEAR][FILTRATION__PUSHES][FILTRATION__LANES];
    int64_t links[FILTRATION__Q];  /* number along each direction, from the sphere */
    filtration__paths path;        /* along the present direction */
    double whole;                  /* 0: half-way, otherwise 1 */
    filtration__batch inner, edge; /* links of nodes whose neighbours all lie in the box, and of others */
} filtration__visit;

/* Finds for the links of a batch, along c from the sphere, where the surface is and how it moves. */
FILTRATION__INLINE void filtration__cut_lanes(const filtration__ball *b, const double *c, filtration__batch *s, int end,
                                              int half_way) {
    const double v[3] = {b->velocity[0], b->velocity[1], b->velocity[2]},
                 spin[3] = {b->spin[0], b->spin[1], b->spin[2]};
    const double cx = c[0], cy = c[1], cz = c[2], cc = cx * cx + cy * cy + cz * cz;
    const double rr = b->radius * b->radius, share = half_way ? 0.0 : 1.0 / cc, half = half_way ? 0.5 : 0.0;
    double along[FILTRATION__ROOM], root[FILTRATION__ROOM];
    for (int k = 0; k < end; k++) {
        const double dx = s->d[0][k], dy = s->d[1][k], dz = s->d[2][k], cd = -(dx * cx) - dy * cy - dz * cz,
                     rest = cd * cd - cc * (dx * dx + dy * dy + dz * dz - rr);
        along[k] = cd, root[k] = 0.5 * (rest + fabs(rest)); /* 0 where it would be negative: a link that grazes */
    }
    for (int k = 0; k < end; k++) root[k] = sqrt(root[k]); /* a loop of its own: gcc takes errno for control flow */
    FILTRATION__INDEPENDENT
    for (int k = 0; k < end; k++) {
        const double q = half + share * (-along[k] - root[k]);
        const double ex = s->d[0][k] - q * cx, ey = s->d[1][k] - q * cy, ez = s->d[2][k] - q * cz;
        const double ux = v[0] + spin[1] * ez - spin[2] * ey, uy = v[1] + spin[2] * ex - spin[0] * ez,
                     uz = v[2] + spin[0] * ey - spin[1] * ex;
        s->fraction[k] = q, s->d[0][k] = ex, s->d[1][k] = ey, s->d[2][k] = ez;
        s->push[k] = -s->w[k] * (cx * ux + cy * uy + cz * uz);
    }
}
FILTRATION__CLONES(filtration__cut_batch,
                   (const filtration__ball *b, const double *c, filtration__batch *s, int end, int half_way),
                   (b, c, s, end, half_way), filtration__cut_lanes(b, c, s, end, half_way))

/* Adds the momentum exchange of links, Galilean invariant (Wen et al. 2014). Half of the sum of the outgoing and
   returning population is w times the density there. */
FILTRATION__INLINE void filtration__exchange_lanes(const filtration__ball *b, const double *c,
                                                   const filtration__batch *s, int end,
                                                   double part[FILTRATION__SUMS][FILTRATION__LANES]) {
    const double v[3] = {b->velocity[0], b->velocity[1], b->velocity[2]},
                 spin[3] = {b->spin[0], b->spin[1], b->spin[2]};
    const double cx = c[0], cy = c[1], cz = c[2];
    for (int first = 0; first < end; first += FILTRATION__LANES) FILTRATION__INDEPENDENT
    for (int lane = 0; lane < FILTRATION__LANES; lane++) {
        const int k = first + lane;
        const double x = s->d[0][k], y = s->d[1][k], z = s->d[2][k];
        const double both = s->out[k] + s->back[k], less = s->out[k] - s->back[k], w = s->w[k], wr = 0.5 * both;
        const double fx = -cx * both - (v[0] + spin[1] * z - spin[2] * y) * less,
                     fy = -cy * both - (v[1] + spin[2] * x - spin[0] * z) * less,
                     fz = -cz * both - (v[2] + spin[0] * y - spin[1] * x) * less;
        const double wx = w * x, wy = w * y, wz = w * z;
        part[0][lane] += w, part[1][lane] += wr;
        part[2][lane] += wx, part[3][lane] += wy, part[4][lane] += wz;
        part[5][lane] += wr * x, part[6][lane] += wr * y, part[7][lane] += wr * z;
        part[8][lane] += wx * x, part[9][lane] += wy * y, part[10][lane] += wz * z;
        part[11][lane] += wy * z, part[12][lane] += wz * x, part[13][lane] += wx * y;
        part[14][lane] += wy * cz - wz * cy, part[15][lane] += wz * cx - wx * cz, part[16][lane] += wx * cy - wy * cx;
        part[17][lane] += fx, part[18][lane] += fy, part[19][lane] += fz;
        part[20][lane] += y * fz - z * fy, part[21][lane] += z * fx - x * fz, part[22][lane] += x * fy - y * fx;
    }
}
FILTRATION__CLONES(filtration__exchange_batch,
                   (const filtration__ball *b, const double *c, const filtration__batch *s, int end,
                    double part[FILTRATION__SUMS][FILTRATION__LANES]),
                   (b, c, s, end, part), filtration__exchange_lanes(b, c, s, end, part))

static inline double filtration__add_lanes(const double part[FILTRATION__LANES]) {
    double sum = part[0];
    for (int lane = 1; lane < FILTRATION__LANES; lane++) sum += part[lane];
    return sum;
}

/* Fits density + slope . d to the density at a sphere's links, by least squares. The more of the surface is hidden, the
   more the slope is reduced. A constant density is met exactly. */
static inline void filtration__fit_density(filtration__ball *b, const filtration__surface *s) {
    double mean[3], m[6], right[3], minor[3];
    b->density = b->slope[0] = b->slope[1] = b->slope[2] = 0.0;
    if (!(s->weight > 0.0)) return;
    for (int a = 0; a < 3; a++) mean[a] = s->place[a] / s->weight, right[a] = s->rise[a] - s->density * mean[a];
    for (int a = 0; a < 3; a++) {
        const int y = (a + 1) % 3, z = (a + 2) % 3;
        m[a] = s->spread[a] - s->weight * mean[a] * mean[a] + 0.01 * s->weight * b->radius * b->radius;
        m[3 + a] = s->spread[3 + a] - s->weight * mean[y] * mean[z];
    }
    minor[0] = m[1] * m[2] - m[3] * m[3], minor[1] = m[3] * m[4] - m[5] * m[2], minor[2] = m[5] * m[3] - m[1] * m[4];
    const double whole = m[0] * minor[0] + m[5] * minor[1] + m[4] * minor[2];
    if (whole > 0.0) {
        b->slope[0] = (right[0] * minor[0] + right[1] * minor[1] + right[2] * minor[2]) / whole;
        b->slope[1] =
            (right[0] * minor[1] + right[1] * (m[0] * m[2] - m[4] * m[4]) + right[2] * (m[4] * m[5] - m[0] * m[3])) /
            whole;
        b->slope[2] =
            (right[0] * minor[2] + right[1] * (m[4] * m[5] - m[0] * m[3]) + right[2] * (m[0] * m[1] - m[5] * m[5])) /
            whole;
    }
    b->density = s->density / s->weight - filtration__dot(b->slope, mean);
}

/* Applies the links of a batch, along j from sphere n. */
static inline void filtration__bounce_ball(filtration__lattice *l, ptrdiff_t n, filtration__visit *v,
                                           filtration__batch *s, int j) {
    const filtration__ball *b = &l->balls[n];
    const filtration__gaps *gaps = &l->gaps[n];
    const double *c = l->real_c[j];
    if (s->n == 0) return;
    if (s == &v->inner) filtration__read_batch(l, s, &v->path);
    const int end = filtration__pad_batch(s);
    filtration__cut_batch(b, c, s, end, l->half_way);
    filtration__bounce_batch(s, end);
    filtration__write_batch(l, s);
    filtration__exchange_batch(b, c, s, end, v->part);
    const double low = s->d[2][0] - 1.0,
                 high = s->d[2][s->n - 1] + 1.0; /* links are sorted by z, and shorter than that */
    for (int m = 0; m < gaps->count; m++)
        if (filtration__may_reach(b, &gaps->near[m], low, high))
            filtration__push_batch(s, end, gaps->near[m].normal, gaps->near[m].cap,
                                   -filtration__dot(c, gaps->near[m].normal), v->push[m]);
    v->links[j] += s->n;
    s->n = 0;
}

/* Returns whether node s of the sphere has a fluid neighbour p along j, which then lies in the box; otherwise counts a
   film. */
static inline int filtration__meets_fluid(const filtration__lattice *l, int32_t index, filtration__ball *b, int s[3],
                                          int p[3]) {
    int mirrored;
    if (!filtration__inside(l, s, &mirrored) || l->owner[filtration__node(l, s[0], s[1], s[2])] != index) return 0;
    const int from_image = mirrored, there = filtration__inside(l, p, &mirrored);
    if (there && mirrored) return 0;
    if (there && l->owner[filtration__node(l, p[0], p[1], p[2])] == FILTRATION__FLUID) return 1;
    b->films += !from_image;
    return 0;
}

/* A row of a sphere's nodes. */
typedef struct filtration__run {
    int first, end, y, z, at; /* at: place in the block */
    double dy, dz;            /* from the centre */
    ptrdiff_t place, node;    /* of x = 0 */
} filtration__run;

/* Gathers links from nodes first .. end of a row, fewer than FILTRATION__BATCH, whose neighbours' neighbours all exist.
   Without branches, because the places of links follow no pattern. */
FILTRATION__INLINE void filtration__gather_row(const filtration__lattice *l, int32_t index, filtration__ball *b,
                                               filtration__visit *v, const filtration__run *r, int j, int first,
                                               int end) {
    filtration__batch *s = &v->inner;
    const double *c = l->real_c[j], dx = c[0] - b->centre[0], dy = r->dy + c[1], dz = r->dz + c[2], w = l->w[j],
                 whole = v->whole;
    const ptrdiff_t next = v->path.node_behind, place = r->place + l->next_place[j];
    const int32_t *owner = l->owner + r->node;
    int k = s->n, films = 0;
    const char *f = (const char *)l->f;
    const ptrdiff_t size = l->single ? 4 : 8;
    for (int x = first; x <= end; x++) {
        const int own = owner[x] == index, fluid = owner[x + next] == FILTRATION__FLUID;
        s->d[0][k] = x + dx, s->d[1][k] = dy, s->d[2][k] = dz, s->w[k] = w;
        s->place[k] = place + x, s->free[k] = owner[x + 2 * next] == FILTRATION__FLUID ? whole : 0.0;
        FILTRATION__PREFETCH(f + size * (place + x + v->path.out)),
            FILTRATION__PREFETCH(f + size * (place + x + v->path.in));
        FILTRATION__PREFETCH(f + size * (place + x + v->path.other)),
            FILTRATION__PREFETCH(f + size * (place + x + v->path.behind));
        k += own & fluid, films += own & !fluid;
    }
    s->n = k, b->films += films;
}

/* Gathers the links of nodes first .. end of a row along j, and applies them when the batch is full. inner: all
   neighbours of the row of their neighbours lie in the box, but for its ends. */
FILTRATION__INLINE void filtration__gather_part(filtration__lattice *l, int32_t index, filtration__ball *b,
                                                filtration__visit *v, const filtration__run *r, int j, int inner,
                                                int first, int end) {
    const signed char *c = l->c[j];
    if (inner && first + c[0] > 0 && end + c[0] < l->nx - 1) {
        for (int x = first; x <= end; x += FILTRATION__BATCH) {
            filtration__gather_row(l, index, b, v, r, j, x,
                                   end - x < FILTRATION__BATCH ? end : x + FILTRATION__BATCH - 1);
            if (v->inner.n >= FILTRATION__BATCH) filtration__bounce_ball(l, index, v, &v->inner, j);
        }
        return;
    }
    filtration__batch *s = &v->edge;
    for (int x = first; x <= end; x++) {
        int p[3] = {x + c[0], r->y + c[1], r->z + c[2]}, at[3] = {x, r->y, r->z};
        const int k = s->n;
        s->d[0][k] = p[0] - b->centre[0], s->d[1][k] = p[1] - b->centre[1], s->d[2][k] = p[2] - b->centre[2],
        s->w[k] = l->w[j];
        if (!filtration__meets_fluid(l, index, b, at, p)) continue;
        filtration__gather_link(l, s, p, filtration__opposite(j));
        if (s->n == FILTRATION__BATCH) filtration__bounce_ball(l, index, v, s, j);
    }
}

/* What is done with the links of nodes first .. end of a row along j. */
typedef void (*filtration__part_fn)(filtration__lattice *l, int32_t index, filtration__ball *b, filtration__visit *v,
                                    const filtration__run *r, int j, int inner, int first, int end);

/* A block of rows of a sphere, along y and z, that are visited together with the rows beside it. */
enum { FILTRATION__ROWS = 32, FILTRATION__SIZE = FILTRATION__ROWS + 2 };
typedef struct filtration__block {
    int count, from[FILTRATION__SIZE * FILTRATION__SIZE],
        to[FILTRATION__SIZE * FILTRATION__SIZE];     /* nodes inside the sphere */
    char inner[FILTRATION__SIZE * FILTRATION__SIZE]; /* 1: all neighbours of the row lie in the box, but for its ends */
    filtration__run run[FILTRATION__ROWS * FILTRATION__ROWS];
} filtration__block;

static inline void filtration__list_rows(const filtration__lattice *l, const filtration__ball *b, const int y[2],
                                         const int z[2], filtration__block *rows) {
    rows->count = 0;
    for (int k = z[0] - 1; k <= z[1] + 1; k++)
        for (int m = y[0] - 1; m <= y[1] + 1; m++) {
            const int at = (k - z[0] + 1) * FILTRATION__SIZE + m - y[0] + 1;
            filtration__chord(b, m, k, &rows->from[at], &rows->to[at]);
            rows->inner[at] = m > 0 && k > 0 && m < l->ny - 1 && k < l->nz - 1;
            if (m < y[0] || m > y[1] || k < z[0] || k > z[1] || rows->from[at] > rows->to[at]) continue;
            const filtration__run r = {rows->from[at],
                                       rows->to[at],
                                       m,
                                       k,
                                       at,
                                       m - b->centre[1],
                                       k - b->centre[2],
                                       filtration__inner_place(l, 0, m, k),
                                       filtration__node(l, 0, m, k)};
            rows->run[rows->count++] = r;
        }
}

/* Visits the links of a block of rows, direction by direction: in every row those of nodes whose neighbour along j is
   outside. */
FILTRATION__INLINE void filtration__block_links(filtration__lattice *l, int32_t index, filtration__ball *b,
                                                filtration__visit *v, const filtration__block *rows,
                                                const filtration__part_fn part) {
    for (int j = 1; j < l->q; j++) {
        const int cx = l->c[j][0], next = l->c[j][2] * FILTRATION__SIZE + l->c[j][1];
        if (v) v->path = filtration__paths_of(l, filtration__opposite(j));
        for (int k = 0; k < rows->count; k++) {
            const filtration__run *r = &rows->run[k];
            const int at = r->at + next, inner = rows->inner[at], in = rows->from[at] - cx, out = rows->to[at] - cx;
            if (in > out) {
                part(l, index, b, v, r, j, inner, r->first, r->end);
                continue;
            }
            if (r->first < in) part(l, index, b, v, r, j, inner, r->first, r->end < in ? r->end : in - 1);
            if (r->end > out) part(l, index, b, v, r, j, inner, out + 1 > r->first ? out + 1 : r->first, r->end);
        }
        if (v) filtration__bounce_ball(l, index, v, &v->inner, j), filtration__bounce_ball(l, index, v, &v->edge, j);
    }
}

/* Visits all links of a sphere. */
FILTRATION__INLINE void filtration__ball_links(filtration__lattice *l, int32_t index, filtration__ball *b,
                                               filtration__visit *v, const filtration__part_fn part) {
    filtration__block rows;
    int y0, y1, z0, z1;
    filtration__extent(b, 1, &y0, &y1);
    filtration__extent(b, 2, &z0, &z1);
    for (int z = z0; z <= z1; z += FILTRATION__ROWS)
        for (int y = y0; y <= y1; y += FILTRATION__ROWS) {
            const int ys[2] = {y, y1 < y + FILTRATION__ROWS ? y1 : y + FILTRATION__ROWS - 1},
                      zs[2] = {z, z1 < z + FILTRATION__ROWS ? z1 : z + FILTRATION__ROWS - 1};
            filtration__list_rows(l, b, ys, zs, &rows);
            filtration__block_links(l, index, b, v, &rows, part);
        }
}

/* Applies all links of sphere n. */
static inline void filtration__apply_ball(filtration__lattice *l, ptrdiff_t n) {
    filtration__ball *b = &l->balls[n];
    filtration__gaps *gaps = &l->gaps[n];
    filtration__visit v;
    filtration__surface sum;
    double *sums = (double *)&sum;
    memset(v.part, 0, sizeof v.part), memset(v.links, 0, sizeof v.links);
    v.inner.n = v.edge.n = 0, v.whole = l->half_way ? 0.0 : 1.0;
    filtration__find_near(l, n, gaps);
    memset(v.push, 0, (size_t)gaps->count * sizeof v.push[0]);
    b->films = b->hull[0] = b->hull[1] = b->hull[2] = 0;
    filtration__ball_links(l, (int32_t)n, b, &v, filtration__gather_part);
    for (int k = 0; k < FILTRATION__SUMS; k++) sums[k] = filtration__add_lanes(v.part[k]);
    for (int m = 0; m < gaps->count; m++)
        for (int k = 0; k < FILTRATION__PUSHES; k++) gaps->near[m].push[k] = filtration__add_lanes(v.push[m][k]);
    filtration__fit_density(b, &sum);
    for (int a = 0; a < 3; a++) {
        b->force[0][a] = sum.force[a];
        b->torque[0][a] = sum.torque[a] + 2.0 * b->density * sum.arm[a]; /* a constant pressure turns no sphere */
        for (int j = 1; j < l->q; j++) b->hull[a] -= v.links[j] * l->c[j][a] * l->whole_weight[j];
    }
    b->steps++;
}

FILTRATION__STATIC void filtration__ball_task(void *context, int task) {
    filtration__lattice *l = (filtration__lattice *)context;
    for (ptrdiff_t n = task; n < l->ball_count; n += FILTRATION__TASKS) {
        filtration__ball *b = &l->balls[n];
        l->gaps[n].count = 0;
        if (!(b->radius > 0.0)) continue;
        memcpy(b->force[1], b->force[0], sizeof b->force[0]);
        memcpy(b->torque[1], b->torque[0], sizeof b->torque[0]);
        filtration__apply_ball(l, n);
    }
}

/* Returns the deviation of density, and the velocity, of a node between steps, from the populations that the next step
   reads. */
static inline double filtration__moments(const filtration__lattice *l, int x, int y, int z, double u[3]) {
    double r = 0.0;
    for (int a = 0; a < 3; a++) u[a] = 0.5 * l->rates.force[a];
    for (int i = 0; i < l->q; i++) {
        double h = filtration__get(l, filtration__incoming(l, x, y, z, i));
        r += h;
        for (int a = 0; a < 3; a++) u[a] += l->c[i][a] * h;
    }
    return r;
}

/* Sets the populations of a node that a sphere has left. d: from the sphere's centre. Without a fluid neighbour: the
   density at the sphere's surface. */
static inline void filtration__fill(filtration__lattice *l, const filtration__ball *b, int x, int y, int z,
                                    const double d[3]) {
    double r = 0.0, u[3], near_u[3] = {0, 0, 0}, best = -HUGE_VAL, near_r = 0.0, mean[FILTRATION__Q] = {0};
    int count = 0, from[3] = {0, 0, 0}, mirrored;
    for (int j = 1; j < l->q; j++) {
        int p[3] = {x + l->c[j][0], y + l->c[j][1], z + l->c[j][2]};
        if (!filtration__inside(l, p, &mirrored) || mirrored) continue;
        if (l->owner[filtration__node(l, p[0], p[1], p[2])] != FILTRATION__FLUID) continue;
        double v[3], density = filtration__moments(l, p[0], p[1], p[2], v), cc = 0.0, along = 0.0;
        for (int a = 0; a < 3; a++) cc += (double)(l->c[j][a] * l->c[j][a]), along += l->c[j][a] * d[a];
        along /= sqrt(cc);
        r += density;
        count++;
        for (int i = 0; i < l->q; i++) mean[i] += filtration__get(l, filtration__incoming(l, p[0], p[1], p[2], i));
        if (!(along > best)) continue;
        best = along, near_r = density;
        memcpy(from, p, sizeof from);
        memcpy(near_u, v, sizeof near_u);
    }
    r = count ? r / count : filtration__density_at(b, d);
    filtration__surface_velocity(b, d, u);
    for (int i = 0; i < l->q; i++) {
        double h = filtration__equilibrium(l, i, r, u);
        if (count && l->refill == (int)FILTRATION_REFILL_NONEQUILIBRIUM)
            h += filtration__get(l, filtration__incoming(l, from[0], from[1], from[2], i)) -
                 filtration__equilibrium(l, i, near_r, near_u);
        if (count && l->refill == (int)FILTRATION_REFILL_INTERPOLATION) h = mean[i] / count;
        filtration__put(l, filtration__incoming(l, x, y, z, i), h);
    }
}

/* Fills the nodes that a sphere has left, all from old fluid. A second call with done 1 makes them fluid. */
static inline void filtration__fill_left(filtration__lattice *l, const filtration__ball *now,
                                         const filtration__ball *before, int done) {
    int y0, y1, z0, z1, mirrored;
    filtration__extent(before, 1, &y0, &y1);
    filtration__extent(before, 2, &z0, &z1);
    for (int z = z0; z <= z1; z++)
        for (int y = y0; y <= y1; y++) {
            int a, b, from, to;
            filtration__chord(before, y, z, &a, &b);
            filtration__chord(now, y, z, &from, &to);
            for (int x = a; x <= b; x++) {
                if (x >= from && x <= to) x = to + 1;
                if (x > b) break;
                int p[3] = {x, y, z};
                if (!filtration__inside(l, p, &mirrored) || mirrored) continue;
                int32_t *owner = &l->owner[filtration__node(l, p[0], p[1], p[2])];
                if (*owner != FILTRATION__FRESH) continue;
                double d[3] = {x - before->centre[0], y - before->centre[1], z - before->centre[2]};
                if (done) *owner = FILTRATION__FLUID;
                else filtration__fill(l, now, p[0], p[1], p[2], d);
            }
        }
}
