/* How well groups of particles are mixed. Reads a const world; writes the caller's arrays. */
#pragma once
#include "measure.h"

DEM_API dem_status dem_count_in_cells(const dem_world *world, const dem_cells *cells, int group, double *of_group,
                                      double *of_all) {
    const dem_world *w = world;
    if (!w || !w->def.allocator.fn || !dem__are_cells(cells) || !of_group || !of_all) return DEM_BAD_ARGUMENT;
    dem_cells sharp = *cells;
    const ptrdiff_t number = (ptrdiff_t)sharp.n[0] * sharp.n[1] * sharp.n[2];
    sharp.width[0] = sharp.width[1] = sharp.width[2] = 0.0;
    for (ptrdiff_t k = 0; k < number; k++) of_group[k] = of_all[k] = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dem_vec x, v;
        int at[3], last;
        if (!w->alive[i] || !dem__counts(w, i, &x, &v) || !dem__cells_of(&sharp, 0, x.x, &at[0], &last) ||
            !dem__cells_of(&sharp, 1, x.y, &at[1], &last) || !dem__cells_of(&sharp, 2, x.z, &at[2], &last))
            continue;
        const ptrdiff_t k = ((ptrdiff_t)at[2] * sharp.n[1] + at[1]) * sharp.n[0] + at[0];
        of_all[k] += 1.0;
        of_group[k] += w->group[i] == group ? 1.0 : 0.0;
    }
    return DEM_OK;
}

/* Computes mixing indices. The variance of a random mixture is that of sampling without replacement: p q (N - n)/(n (N
   - 1)) for a sample of n out of N. */
DEM_API dem_mixing dem_mixing_of(ptrdiff_t samples, const double *of_group, const double *of_all) {
    const double none = (double)NAN;
    dem_mixing m = {none, none, none, none, none, none};
    double group = 0.0, all = 0.0, used = 0.0, square = 0.0;
    if (samples < 1 || !of_group || !of_all) return m;
    for (ptrdiff_t k = 0; k < samples; k++) {
        if (!(of_group[k] >= 0.0 && of_all[k] >= of_group[k]) || !dem__finite(of_all[k])) return m;
        group += of_group[k], all += of_all[k], used += of_all[k] > 0.0 ? 1.0 : 0.0;
    }
    const double p = group / all;
    if (!(p > 0.0 && p < 1.0)) return m;
    for (ptrdiff_t k = 0; k < samples; k++) {
        const double d = of_all[k] > 0.0 ? of_group[k] / of_all[k] - p : 0.0;
        square += of_all[k] * d * d;
    }
    m.share = p;
    m.separated = p * (1.0 - p);
    m.random = m.separated * (used - 1.0) / (all - 1.0);
    m.variance = square / all;
    m.lacey = (m.separated - m.variance) / (m.separated - m.random);
    m.segregation = m.variance / m.separated;
    return m;
}

DEM_API double dem_unlike_contacts(const dem_world *world, int group) {
    double unlike = 0.0, all = 0.0, ends = 0.0;
    if (!world || !world->engine) return (double)NAN;
    DEM__EACH_CONTACT(world, k) {
        const int32_t i = world->engine->contacts.i[k], j = world->engine->contacts.j[k];
        if (j < 0 || !(world->engine->contacts.gap[k] < 0.0)) continue;
        const int a = world->group[i] == group, b = world->group[j] == group;
        unlike += a != b, ends += a + b, all += 1.0;
    }
    const double p = ends / (2.0 * all);
    return unlike / (all * 2.0 * p * (1.0 - p));
}
