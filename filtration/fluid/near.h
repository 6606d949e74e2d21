/* Spheres so near to each other that the lattice does not resolve how the liquid leaves the gap. There the lattice's force along the line
   of centres gives way to lubrication; the force of the liquid around the gap stays. */
#pragma once
#include "batch.h"
#include "../../base/portable_math.h"

/* ==== >>near ==== */

/* The gap between two spheres at some distance from their line is h + rho^2 / (2 r), r: reduced radius. Where it is below `cap`, the pressure
   is that of lubrication: integrated, 6 pi mu r^2 v (1 / h - 1 / cap). 1.75 voxels: calibrated (docs/filtration.md, two spheres). */
#define FILTRATION__CAP 1.75
/* The same force at this gap [voxel] acts below it, because a larger one would need an implicit step: filtration_lubrication_force with this
   cutoff adds what is missing. */
#define FILTRATION__FILM (2.0 / 3.0)

/* Lists the spheres near sphere n, in their order; at most FILTRATION__NEAR. */
static inline void filtration__find_near(const filtration__lattice *l, ptrdiff_t n, filtration__gaps *gaps) {
    const int nodes[3] = {l->nx, l->ny, l->nz};
    const filtration__ball *b = &l->balls[n];
    gaps->count = 0;
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
        const double distance = sqrt(dd), gap = distance - sum > 0.0 ? distance - sum : 0.0;
        filtration__near *f = &gaps->near[gaps->count++];
        f->other = (int32_t)k, f->gap = gap;
        for (int a = 0; a < 3; a++) f->normal[a] = d[a] / distance;
        f->cap = b->radius - (FILTRATION__CAP - gap) * other->radius / sum;
        if (!(f->cap > 0.0)) f->cap = 0.0;
    }
}

/* Adds for the links within the cap the force along the normal, and what a density of 1 and a slope of 1 along each axis would give.
   along: of what a link brings, the part along the normal. */
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

/* Returns the force along the normal that the lattice's links within the cap exert on the sphere, over that of the line fitted to its
   density: a constant pressure has none. */
static inline double filtration__cap_force(const filtration__ball *b, const filtration__near *f) {
    return f->push[0] - f->push[1] * b->density - f->push[2] * b->slope[0] - f->push[3] * b->slope[1] -
           f->push[4] * b->slope[2];
}

/* Exchanges the lattice's force in the gaps beside sphere n, the mean of both spheres', for lubrication: equal and opposite forces. */
static inline void filtration__lubricate(filtration__lattice *l, ptrdiff_t n, double viscosity) {
    filtration__ball *b = &l->balls[n];
    for (int m = 0; m < l->gaps[n].count; m++) {
        const filtration__near *f = &l->gaps[n].near[m];
        const filtration__gaps *back = &l->gaps[f->other];
        const filtration__ball *other = &l->balls[f->other];
        int at = 0;
        while (at < back->count && back->near[at].other != (int32_t)n) at++;
        if (at == back->count) continue; /* its list is full */
        const double r = b->radius * other->radius / (b->radius + other->radius),
                     h = f->gap > FILTRATION__FILM ? f->gap : FILTRATION__FILM;
        double closing = 0.0;
        for (int a = 0; a < 3; a++) closing += (b->velocity[a] - other->velocity[a]) * f->normal[a];
        const double push = 0.5 * (filtration__cap_force(b, f) + filtration__cap_force(other, &back->near[at])) +
                            6.0 * RIDDLE_PI * viscosity * r * r * (1.0 / h - 1.0 / FILTRATION__CAP) * closing;
        for (int a = 0; a < 3; a++) b->force[0][a] -= push * f->normal[a];
    }
}
