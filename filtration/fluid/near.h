/* Spheres so close to each other or to a wall that the lattice does not resolve how the liquid leaves the gap. There
   lubrication replaces the lattice's force along the line of centres. The force of the liquid around the gap stays. */
#pragma once
#include "batch.h"
#include "../../base/portable_math.h"

/* ==== >>near ==== */

/* The gap between two spheres at a distance rho from their line is h + rho^2 / (2 r), r: reduced radius. Where it is
   below `cap`, the pressure is that of lubrication; integrated: 6 pi mu r^2 v (1 / h - 1 / cap). 1.75 voxels:
   calibrated (docs/filtration.md, two spheres). */
#define FILTRATION__CAP 1.75
#define FILTRATION__WALL_CAP 1.0 /* at a wall, which lies between two nodes */
/* Below this gap [voxel] the force at this gap acts, because a larger one would need an implicit step.
   filtration_lubrication_force with this cutoff adds the rest. */
#define FILTRATION__FILM (2.0 / 3.0)

/* Sets the cap of a gap, up to `most`, beside a sphere of that radius. share: part of the gap's widening that is due to
   the other surface. */
static inline void filtration__set_cap(filtration__near *f, double radius, double gap, double most, double share) {
    f->gap = gap > 0.0 ? gap : 0.0;
    f->cap = radius - (most - f->gap) * (1.0 - share);
    if (!(f->cap > 0.0)) f->cap = 0.0;
}

/* Lists the spheres near sphere n, in their order, and the walls: at most FILTRATION__NEAR. */
static inline void filtration__find_near(const filtration__lattice *l, ptrdiff_t n, filtration__gaps *gaps) {
    const int nodes[3] = {l->nx, l->ny, l->nz};
    const filtration__ball *b = &l->balls[n];
    gaps->count = 0;
    for (int face = 0; face < 6; face++) {
        const int a = face / 2, high = face & 1;
        const double gap = (high ? nodes[a] - 0.5 - b->centre[a] : b->centre[a] + 0.5) - b->radius;
        if (!l->face[face]->is_touched || !(gap < FILTRATION__WALL_CAP) || !(gap > -b->radius)) continue;
        filtration__near *f = &gaps->near[gaps->count++];
        f->other = -1, f->normal[0] = f->normal[1] = f->normal[2] = 0.0, f->normal[a] = high ? 1.0 : -1.0;
        filtration__set_cap(f, b->radius, gap, FILTRATION__WALL_CAP, 0.0);
    }
    for (ptrdiff_t k = 0; k < l->ball_count && gaps->count < FILTRATION__NEAR; k++) {
        const filtration__ball *other = &l->balls[k];
        const double sum = b->radius + other->radius, reach = sum + FILTRATION__CAP;
        double d[3] = {0, 0, 0}, dd = 0.0;
        for (int a = 0; a < 3 && dd < reach * reach; a++) {
            d[a] = other->centre[a] - b->centre[a];
            if (l->repeats[a]) d[a] -= nodes[a] * floor(d[a] / nodes[a] + 0.5);
            dd += d[a] * d[a];
        }
        if (!(dd < reach * reach) || !(dd > 0.0) || !(other->radius > 0.0) || k == n) continue;
        const double distance = sqrt(dd);
        filtration__near *f = &gaps->near[gaps->count++];
        f->other = (int32_t)k;
        for (int a = 0; a < 3; a++) f->normal[a] = d[a] / distance;
        filtration__set_cap(f, b->radius, distance - sum, FILTRATION__CAP, b->radius / sum);
    }
}

/* Adds, for the links within the cap, the force along the normal, and the forces that a density of 1 and a slope of 1
   along each axis would give. along: the part along the normal of what a link carries. */
FILTRATION__INLINE void filtration__push_lanes(const filtration__batch *s, int end, const double normal[3], double cap,
                                               double along, double part[FILTRATION__PUSHES][FILTRATION__LANES]) {
    const double nx = normal[0], ny = normal[1], nz = normal[2];
    int hit = 0;
    for (int k = 0; k < end; k++) hit |= s->d[0][k] * nx + s->d[1][k] * ny + s->d[2][k] * nz > cap;
    if (!hit) return;
    for (int first = 0; first < end; first += FILTRATION__LANES) FILTRATION__INDEPENDENT
    for (int lane = 0; lane < FILTRATION__LANES; lane++) {
        const int k = first + lane;
        const double x = s->d[0][k], y = s->d[1][k], z = s->d[2][k],
                     share = x * nx + y * ny + z * nz > cap ? along : 0.0, of_one = 2.0 * s->w[k] * share;
        part[0][lane] += share * (s->out[k] + s->back[k]), part[1][lane] += of_one;
        part[2][lane] += of_one * x, part[3][lane] += of_one * y, part[4][lane] += of_one * z;
    }
}
FILTRATION__CLONES(filtration__push_batch,
                   (const filtration__batch *s, int end, const double normal[3], double cap, double along,
                    double part[FILTRATION__PUSHES][FILTRATION__LANES]),
                   (s, end, normal, cap, along, part), filtration__push_lanes(s, end, normal, cap, along, part))

/* Returns whether the surface of a sphere between two heights [nodes] may lie within the cap. */
static inline int filtration__may_reach(const filtration__ball *b, const filtration__near *f, double low, double high) {
    const double top = f->normal[2] * b->radius, z = top < low ? low : top > high ? high : top;
    const double rest = b->radius * b->radius - z * z, flat = 1.0 - f->normal[2] * f->normal[2];
    return !(z * f->normal[2] + sqrt((rest > 0.0 ? rest : 0.0) * (flat > 0.0 ? flat : 0.0)) <
             f->cap - 1e-6 * b->radius);
}

/* Returns the force along the normal that the lattice's links within the cap exert on the sphere, beyond that of the
   line fitted to its density, so that a constant pressure gives none. */
static inline double filtration__cap_force(const filtration__ball *b, const filtration__near *f) {
    return f->push[0] - f->push[1] * b->density - f->push[2] * b->slope[0] - f->push[3] * b->slope[1] -
           f->push[4] * b->slope[2];
}

/* Returns the force with which a film of reduced radius r resists an approach, over its velocity. */
static inline double filtration__film_rate(double r, double gap, double most, double viscosity) {
    const double h = gap > FILTRATION__FILM ? gap : FILTRATION__FILM;
    return 6.0 * RIDDLE_PI * viscosity * r * r * (1.0 / h - 1.0 / most);
}

/* Replaces the lattice's force in the gaps beside sphere n by lubrication: between two spheres the mean of both forces,
   so that they get equal and opposite ones. */
static inline void filtration__lubricate(filtration__lattice *l, ptrdiff_t n, double viscosity) {
    filtration__ball *b = &l->balls[n];
    for (int m = 0; m < l->gaps[n].count; m++) {
        const filtration__near *f = &l->gaps[n].near[m];
        double closing = filtration__dot(b->velocity, f->normal), push = filtration__cap_force(b, f), r = b->radius;
        if (f->other >= 0) {
            const filtration__gaps *back = &l->gaps[f->other];
            const filtration__ball *other = &l->balls[f->other];
            int at = 0;
            while (at < back->count && back->near[at].other != (int32_t)n) at++;
            if (at == back->count) continue; /* its list is full */
            push = 0.5 * (push + filtration__cap_force(other, &back->near[at]));
            r = b->radius * other->radius / (b->radius + other->radius);
            closing = 0.0;
            for (int a = 0; a < 3; a++) closing += (b->velocity[a] - other->velocity[a]) * f->normal[a];
        }
        push += filtration__film_rate(r, f->gap, f->other >= 0 ? FILTRATION__CAP : FILTRATION__WALL_CAP, viscosity) *
                closing;
        for (int a = 0; a < 3; a++) b->force[0][a] -= push * f->normal[a];
    }
}
