/* Forces of links, block by block: a law's loop over them, and the sums. */
#pragma once
#include "../contacts/kernel.h"

/* Returns the number of parts into which the links are split. */
DEM_INLINE int dem__link_parts(const dem_world *w) {
    return dem__parts_of(w, w->engine->links.count, w->engine->scratch.works);
}

/* Adds the forces of links first .. end-1 to the loads of their bodies, in the order of the links. */
DEM_INLINE void dem__add_links(dem_world *w, ptrdiff_t first, ptrdiff_t end) {
    dem__bodies *bodies = &w->engine->bodies;
    const dem__links *links = &w->engine->links;
    double *const *out = links->wrench;
    for (ptrdiff_t k = first; k < end; k++) {
        const ptrdiff_t i = links->i[k], j = links->j[k], ahead = k + DEM__AHEAD;
        if (ahead < end) {
            DEM__PREFETCH(bodies->load[links->i[ahead]]);
            DEM__PREFETCH(bodies->load[links->j[ahead] < 0 ? 0 : links->j[ahead]]);
        }
        if (links->ended[k]) continue;
        for (int a = 0; a < 6; a++) bodies->load[i][a] += out[a][k];
        if (j < 0) continue;
        for (int a = 0; a < 3; a++) bodies->load[j][a] -= out[a][k];
        for (int a = 3; a < 6; a++) bodies->load[j][a] += out[3 + a][k];
    }
}

/* Gathers the block of n links from base on, and prefetches the next block. */
DEM_INLINE void dem__gather_links(const dem_world *w, dem__work *x, ptrdiff_t base, int n, ptrdiff_t end) {
    const dem__links *links = &w->engine->links;
    x->walls = 0;
    for (int k = 0; k < n; k++) {
        const ptrdiff_t c = base + k, i = links->i[c], j = links->j[c], ahead = c + DEM__AHEAD;
        if (ahead < end) dem__prefetch_particle(w, links->i[ahead]), dem__prefetch_particle(w, links->j[ahead]);
        if (j >= 0) dem__gather_pair(w->particle, i, j, &x->rows, k, 1);
        else dem__gather_wall(w, i, -1 - j, links->element[c], -1, &x->rows, k, 0.0, &x->wall[x->walls++]);
        x->types.sum[k] = w->particle[i].radius + (j >= 0 ? w->particle[j].radius : 0.0);
        x->types.part[k] = w->particle[i].radius / x->types.sum[k];
    }
    dem__complete_rows(w, &x->rows, &x->types, n, 0.0, 0.5 * w->engine->run.kernel_dt, x->wall, x->walls, 1);
}

/* Evaluates links first .. end - 1 at the present positions. If there is only one thread, it adds up each block while
   it is in the cache. */
DEM_INLINE void dem__link_kernel(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, const dem_law *law) {
    dem__links *links = &w->engine->links;
    dem__work *x = dem__work_of(w, part);
    const double h = w->engine->run.kernel_dt;
    for (ptrdiff_t base = first; base < end; base += DEM__BLOCK) {
        const int n = end - base < DEM__BLOCK ? (int)(end - base) : DEM__BLOCK;
        const size_t bytes = (size_t)n * sizeof(double);
        dem__columns old, at;
        dem__gather_links(w, x, base, n, end);
        for (int a = 0; a < law->states; a++) old.state[a] = links->state[a] + base;
        for (int a = 0; a < 9; a++) old.out[a] = links->wrench[a] + base;
        for (int a = 0; a < law->states; a++) at.state[a] = DEM__COPY_ROWS ? x->block.state[a] : old.state[a];
        for (int a = 0; a < 9; a++) at.out[a] = DEM__COPY_ROWS ? x->block.out[a] : old.out[a];
        dem__apply_law(w, x, links->i + base, links->j + base, n, &old, &at, law, h, 1.0 / h,
                       DEM_FRICTION | DEM__OF_LINKS);
        for (int a = 0; a < law->history && DEM__COPY_ROWS; a++) memcpy(old.state[a], at.state[a], bytes);
        for (int a = 0; a < 9 && DEM__COPY_ROWS; a++) memcpy(old.out[a], at.out[a], bytes);
        memcpy(links->gap + base, x->rows.gap, bytes);
        for (int k = 0; k < n; k++) links->ended[base + k] = x->ended[k] != 0.0;
        if (dem__link_parts(w) == 1) dem__add_links(w, base, base + n);
    }
}

#define DEM_LINK_KERNEL(name, law)                                                                                     \
    DEM__LOOP(name##_loop, dem__link_kernel(world, first, end, part, &(law)))                                          \
    static const dem_link_kernel name = {&(law), name##_loop};
