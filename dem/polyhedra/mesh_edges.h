/* The sharp edges and corners of a mesh, which edges and faces of polyhedra can touch. The table is made once for each
   mesh, in a world with polyhedra. */
#pragma once
#include "../walls/mesh.h"

#define DEM__FLAT_EDGE                                                                                                 \
    1e-3 /* edges: sine of the angle between two triangles up to which they are flat; corners: the same for two edges */

/* For each vertex, finds the first vertex at the same place. */
static inline void dem__weld_places(const dem__tree *t, int32_t *same, dem__keyed *items) {
    for (int32_t v = 0; v < t->vertices; v++) {
        const double x[3] = {t->vertex[v].x + 0.0, t->vertex[v].y + 0.0, t->vertex[v].z + 0.0}; /* no -0 */
        uint64_t hash = 0, bits;
        for (int a = 0; a < 3; a++) {
            memcpy(&bits, &x[a], sizeof bits);
            hash = (hash ^ bits ^ bits >> 29) * 0x9e3779b97f4a7c15u;
        }
        items[v].key = hash, items[v].index = v;
    }
    dem__sort_keyed(items, items + t->vertices, t->vertices);
    for (int32_t k = 0; k < t->vertices; k++) {
        const dem_vec p = t->vertex[items[k].index];
        same[items[k].index] = items[k].index;
        for (int32_t q = k - 1; q >= 0 && items[q].key == items[k].key; q--) {
            const dem_vec other = t->vertex[items[q].index];
            if (p.x == other.x && p.y == other.y && p.z == other.z) same[items[k].index] = same[items[q].index];
        }
    }
}

/* Finds the ends of edge `at`: edge at % 3 of triangle at / 3. */
DEM_INLINE void dem__ends_of(const dem__tree *t, int32_t at, int32_t *from, int32_t *to) {
    *from = t->corner[at], *to = t->corner[at % 3 < 2 ? at + 1 : at - 2];
}
/* Returns the direction from an edge into its triangle, perpendicular to the edge. */
DEM_INLINE dem_vec dem__into_face(const dem__tree *t, int32_t at) {
    int32_t from, to;
    dem__ends_of(t, at, &from, &to);
    const dem_vec along = dem__sub(t->vertex[to], t->vertex[from]);
    return dem__scale(1.0 / dem__length(along), dem__cross(t->normal[at / 3], along));
}

/* Finds the sharp edges. */
static inline void dem__find_mesh_edges(const dem__tree *t, dem__mesh_edges *edges, const int32_t *same,
                                        dem__keyed *items) {
    const ptrdiff_t n = 3 * (ptrdiff_t)t->triangles;
    for (int32_t at = 0; at < (int32_t)n; at++) {
        int32_t from, to;
        dem__ends_of(t, at, &from, &to);
        const int32_t p = same[from], q = same[to];
        items[at].key = (uint64_t)(uint32_t)(p < q ? p : q) << 32 | (uint32_t)(p < q ? q : p), items[at].index = at;
    }
    dem__sort_keyed(items, items + n, n);
    for (ptrdiff_t k = 0, next; k < n; k = next) {
        const int32_t at = items[k].index;
        for (next = k + 1; next < n && items[next].key == items[k].key;) next++;
        edges->kind[at] = next - k == 2 ? 0 : DEM__EDGE | DEM__RIM;
        if (next - k != 2) continue;
        const dem_vec in = dem__into_face(t, at), other = dem__into_face(t, items[k + 1].index),
                      out = dem__add(in, other);
        if (!(fabs(dem__dot(t->normal[at / 3], other)) > DEM__FLAT_EDGE)) continue;
        edges->kind[at] = DEM__EDGE;
        edges->outward[at] = dem__scale(-1.0, out);
    }
}

/* Finds the sharp corners: ends of sharp edges, unless just two sharp edges meet there in one line. */
static inline void dem__find_mesh_corners(const dem__tree *t, dem__mesh_edges *edges, const int32_t *same,
                                          dem__keyed *items) {
    ptrdiff_t n = 0;
    for (int32_t at = 0; at < 3 * t->triangles; at++) {
        int32_t end[2];
        if (!edges->kind[at]) continue;
        dem__ends_of(t, at, &end[0], &end[1]);
        for (int k = 0; k < 2; k++) items[n].key = (uint64_t)(uint32_t)same[end[k]], items[n++].index = 2 * at + k;
    }
    dem__sort_keyed(items, items + n, n);
    for (ptrdiff_t k = 0, next; k < n; k = next) {
        dem_vec sum = dem_vec3(0.0, 0.0, 0.0);
        int rims = 0;
        for (next = k; next < n && items[next].key == items[k].key; next++) {
            const int32_t at = items[next].index / 2;
            int32_t end[2];
            dem__ends_of(t, at, &end[0], &end[1]);
            const int here = items[next].index % 2;
            const dem_vec u = dem__sub(t->vertex[end[1 - here]], t->vertex[end[here]]);
            sum = dem__plus(sum, -1.0 / dem__length(u), u);
            rims |= edges->kind[at] & DEM__RIM;
        }
        if (next - k == 2 && !(dem__length(sum) > DEM__FLAT_EDGE)) continue;
        for (ptrdiff_t q = k; q < next; q++)
            edges->kind[items[q].index / 2] |= items[q].index % 2 ? DEM__TO_END : DEM__FROM_END;
        const int32_t at = items[k].index / 2, keeper = items[k].index % 2 == 0 ? at : at % 3 < 2 ? at + 1 : at - 2;
        edges->kind[keeper] |= DEM__CORNER;
        edges->tip[keeper] = rims ? dem_vec3(0.0, 0.0, 0.0) : sum;
    }
}

/* Makes the table of a mesh that has none. Returns 0 when out of memory. */
static inline int dem__make_mesh_edges(const dem_allocator *a, dem__tree *t) {
    const size_t n = 3 * (size_t)t->triangles, v = (size_t)t->vertices, most = 2 * n > v ? 2 * n : v;
    const size_t bytes = sizeof(dem__mesh_edges) + 2 * n * sizeof(dem_vec) + n;
    const size_t scratch = 2 * most * sizeof(dem__keyed) + v * sizeof(int32_t);
    if (t->edges) return 1;
    dem__mesh_edges *edges = (dem__mesh_edges *)a->fn(a->user, NULL, 0, bytes);
    dem__keyed *items = edges ? (dem__keyed *)a->fn(a->user, NULL, 0, scratch) : NULL;
    if (!items) {
        if (edges) a->fn(a->user, edges, bytes, 0);
        return 0;
    }
    memset(edges, 0, bytes);
    edges->bytes = bytes;
    edges->outward = (dem_vec *)(void *)(edges + 1), edges->tip = edges->outward + n;
    edges->kind = (uint8_t *)(void *)(edges->tip + n);
    int32_t *same = (int32_t *)(void *)(items + 2 * most);
    dem__weld_places(t, same, items);
    dem__find_mesh_edges(t, edges, same, items);
    dem__find_mesh_corners(t, edges, same, items);
    a->fn(a->user, items, scratch, 0);
    t->edges = edges;
    return 1;
}
