/* Moving spheres on the lattice: the nodes that they cover, their links, the force on them, nodes that they leave. */
#pragma once
#include "links.h"

/* ==== >>spheres ==== */

/* Finds the nodes first .. end of the row at (y, z) inside a sphere; first > end: none. */
static inline void filtration__chord(const filtration__ball *b, int y, int z, int *first, int *end) {
    double dy = y - b->centre[1], dz = z - b->centre[2], rest = b->radius * b->radius - (dy * dy + dz * dz);
    *first = 1, *end = 0;
    if (!(rest > 0.0)) return;
    double half = sqrt(rest);
    *first = (int)floor(b->centre[0] - half) + 1, *end = (int)ceil(b->centre[0] + half) - 1;
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

/* Makes `index` the owner of nodes that are inside `now` and not inside `before` (NULL: nothing). With leave 1, and both exchanged, such
   nodes are left. */
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

/* Sums over the links of a sphere, weighted as the lattice is: of the density at its surface and of places, for a line fitted to it. */
typedef struct filtration__surface {
    double weight, density, place[3], rise[3]; /* sums of w, w r, w d, w r d */
    double spread[6];                          /* of w d d: xx, yy, zz, yz, zx, xy */
    double arm[3];                             /* of w (d x c) */
    double force[3], torque[3];
    int64_t links[FILTRATION__Q]; /* number along each direction */
} filtration__surface;

/* Adds the momentum exchange of a link, Galilean invariant (Wen et al. 2014). Half of what goes and comes is w times the
   density there. d: from the centre, u: velocity of the surface. Written out, because there is a link for every few nodes
   of a cake. */
FILTRATION__INLINE void filtration__exchange(const filtration__lattice *l, filtration__surface *s, int i,
                                             const double d[3], const double u[3], double out, double back) {
    const double *c = l->real_c[i], w = l->w[i], both = out + back, less = out - back, wr = 0.5 * both;
    const double fx = c[0] * both - u[0] * less, fy = c[1] * both - u[1] * less, fz = c[2] * both - u[2] * less;
    const double wx = w * d[0], wy = w * d[1], wz = w * d[2];
    s->force[0] += fx, s->force[1] += fy, s->force[2] += fz;
    s->torque[0] += d[1] * fz - d[2] * fy, s->torque[1] += d[2] * fx - d[0] * fz, s->torque[2] += d[0] * fy - d[1] * fx;
    s->links[i]++;
    s->weight += w, s->density += wr;
    s->place[0] += wx, s->place[1] += wy, s->place[2] += wz;
    s->rise[0] += wr * d[0], s->rise[1] += wr * d[1], s->rise[2] += wr * d[2];
    s->spread[0] += wx * d[0], s->spread[1] += wy * d[1], s->spread[2] += wz * d[2];
    s->spread[3] += wy * d[2], s->spread[4] += wz * d[0], s->spread[5] += wx * d[1];
    s->arm[0] += wy * c[2] - wz * c[1], s->arm[1] += wz * c[0] - wx * c[2], s->arm[2] += wx * c[1] - wy * c[0];
}

/* Fits density + slope . d to the density at a sphere's links, by least squares; the more of the surface is hidden, the more the slope is
   held down. A constant density is met exactly. */
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

/* Applies the link from a sphere's node (x, y, z) along j to a fluid node, if there is one; otherwise counts a film. */
static inline void filtration__ball_link(filtration__lattice *l, int32_t index, filtration__ball *b,
                                         filtration__surface *sum, int x, int y, int z, int j) {
    const signed char *c = l->c[j];
    int s[3] = {x, y, z}, p[3] = {x + c[0], y + c[1], z + c[2]}, mirrored;
    double d[3], e[3], u[3], back;
    const int inner = filtration__is_inner(l, p[0], p[1], p[2]);
    for (int a = 0; a < 3; a++) d[a] = p[a] - b->centre[a];
    if (!inner) {
        if (!filtration__inside(l, s, &mirrored) || l->owner[filtration__node(l, s[0], s[1], s[2])] != index) return;
        const int from_image = mirrored, there = filtration__inside(l, p, &mirrored);
        if (there && mirrored) return;
        if (!there || l->owner[filtration__node(l, p[0], p[1], p[2])] != FILTRATION__FLUID) {
            b->films += !from_image;
            return;
        }
    }
    const ptrdiff_t node = filtration__node(l, p[0], p[1], p[2]);
    if (inner) {
        if (l->owner[node - l->next_node[j]] != index) return;
        if (l->owner[node] != FILTRATION__FLUID) {
            b->films++;
            return;
        }
    }
    const double *r = l->real_c[j], cc = l->squared_c[j];
    const double cd = -(d[0] * r[0]) - d[1] * r[1] - d[2] * r[2], dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const double root = cd * cd - cc * (dd - b->radius * b->radius);
    const double fraction = l->half_way ? 0.5 : (-cd - sqrt(root > 0.0 ? root : 0.0)) / cc;
    const int i = filtration__opposite(j);
    for (int a = 0; a < 3; a++) e[a] = d[a] - fraction * r[a];
    filtration__surface_velocity(b, e, u);
    const double cu = -(r[0] * u[0] + r[1] * u[1] + r[2] * u[2]);
    double out;
    if (inner) {
        out = filtration__bounce_inner(l, filtration__inner_place(l, p[0], p[1], p[2]), node, i, fraction, cu, &back);
    } else {
        const filtration__cut k = {p[0], p[1], p[2], i, fraction};
        out = filtration__bounce(l, &k, cu, &back);
    }
    filtration__exchange(l, sum, i, e, u, out, back);
}

/* What is done with a link of a sphere, from its node (x, y, z) along j. */
typedef void (*filtration__link_fn)(filtration__lattice *l, int32_t index, filtration__ball *b,
                                    filtration__surface *sum, int x, int y, int z, int j);

/* Visits all links of a sphere: in every row those of its nodes whose neighbour along j is outside. */
FILTRATION__INLINE void filtration__ball_links(filtration__lattice *l, int32_t index, filtration__ball *b,
                                               filtration__surface *sum, const filtration__link_fn link) {
    int y0, y1, z0, z1;
    filtration__extent(b, 1, &y0, &y1);
    filtration__extent(b, 2, &z0, &z1);
    for (int z = z0; z <= z1; z++)
        for (int y = y0; y <= y1; y++) {
            int first, end, from[3][3], to[3][3];
            filtration__chord(b, y, z, &first, &end);
            if (first > end) continue;
            for (int dz = 0; dz < 3; dz++)
                for (int dy = 0; dy < 3; dy++) {
                    filtration__chord(b, y + dy - 1, z + dz - 1, &from[dz][dy], &to[dz][dy]);
                    if (from[dz][dy] > to[dz][dy]) from[dz][dy] = to[dz][dy] = end + 4;
                }
            for (int j = 1; j < l->q; j++) {
                const signed char *c = l->c[j];
                int in = from[c[2] + 1][c[1] + 1] - c[0], out = to[c[2] + 1][c[1] + 1] - c[0];
                for (int x = first; x <= end && x < in; x++) link(l, index, b, sum, x, y, z, j);
                for (int x = out + 1 > first ? out + 1 : first; x <= end; x++) link(l, index, b, sum, x, y, z, j);
            }
        }
}

FILTRATION__STATIC void filtration__ball_task(void *context, int task) {
    filtration__lattice *l = (filtration__lattice *)context;
    filtration__surface sum;
    for (ptrdiff_t n = task; n < l->ball_count; n += FILTRATION__TASKS) {
        filtration__ball *b = &l->balls[n];
        if (!(b->radius > 0.0)) continue;
        memcpy(b->force[1], b->force[0], sizeof b->force[0]);
        memcpy(b->torque[1], b->torque[0], sizeof b->torque[0]);
        memset(b->force[0], 0, sizeof b->force[0]);
        memset(b->torque[0], 0, sizeof b->torque[0]);
        memset(&sum, 0, sizeof sum);
        b->films = b->hull[0] = b->hull[1] = b->hull[2] = 0;
        filtration__ball_links(l, (int32_t)n, b, &sum, filtration__ball_link);
        filtration__fit_density(b, &sum);
        for (int a = 0; a < 3; a++) {
            b->force[0][a] = sum.force[a];
            b->torque[0][a] = sum.torque[a] - 2.0 * b->density * sum.arm[a]; /* a constant pressure turns no sphere */
            for (int i = 1; i < l->q; i++) b->hull[a] += sum.links[i] * l->c[i][a] * l->whole_weight[i];
        }
        b->steps++;
    }
}

/* Returns the deviation of density, and the velocity, of a node between steps, from the populations that the next step reads. */
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

/* Sets the populations of a node that a sphere has left. d: from the sphere's centre. Without a fluid neighbour: the density at the
   sphere's surface. */
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
