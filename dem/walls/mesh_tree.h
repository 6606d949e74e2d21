/* The tree of a mesh's triangles. */
#pragma once
#include "../base/triangles.h"
#include "add.h"

/* Moves each of 21 bits to every third bit of a Morton code. */
static inline uint64_t dem__interleave(uint64_t v) {
    v = (v | v << 32) & 0x1f00000000ffffu;
    v = (v | v << 16) & 0x1f0000ff0000ffu;
    v = (v | v << 8) & 0x100f00f00f00f00fu;
    v = (v | v << 4) & 0x10c30c30c30c30c3u;
    return (v | v << 2) & 0x1249249249249249u;
}

typedef struct dem__keyed {
    uint64_t key;
    int32_t index;
} dem__keyed;
/* Sorts by key, then index. temporary: room for n items. */
static inline void dem__sort_keyed(dem__keyed *items, dem__keyed *temporary, ptrdiff_t n) {
    for (ptrdiff_t width = 1; width < n; width *= 2) {
        for (ptrdiff_t low = 0; low < n; low += 2 * width) {
            const ptrdiff_t mid = low + width < n ? low + width : n, high = mid + width < n ? mid + width : n;
            for (ptrdiff_t a = low, b = mid, to = low; to < high; to++) {
                const int left = a < mid && (b >= high || items[a].key < items[b].key ||
                                             (items[a].key == items[b].key && items[a].index < items[b].index));
                temporary[to] = left ? items[a++] : items[b++];
            }
        }
        memcpy(items, temporary, (size_t)n * sizeof *items);
    }
}

/* Makes nodes for the triangles first .. end-1, which are sorted along a space-filling curve: one for all, then those
   of each half. */
static inline void dem__grow_node(dem__tree *t, int32_t first, int32_t end) {
    const int32_t at = t->nodes++;
    dem__node *node = &t->node[at];
    node->first = first;
    node->count = end - first <= DEM__LEAF ? end - first : 0;
    for (int a = 0; a < 3; a++) node->low[a] = HUGE_VAL, node->high[a] = -HUGE_VAL;
    for (int32_t k = 3 * first; k < 3 * (first + node->count); k++) {
        for (int a = 0; a < 3; a++) {
            const double v = dem_axis(t->vertex[t->corner[k]], a);
            node->low[a] = v < node->low[a] ? v : node->low[a];
            node->high[a] = v > node->high[a] ? v : node->high[a];
        }
    }
    if (node->count == 0) {
        const int32_t middle = first + (end - first) / 2;
        for (int side = 0; side < 2; side++) {
            const int32_t child = t->nodes;
            dem__grow_node(t, side ? middle : first, side ? end : middle);
            for (int a = 0; a < 3; a++) {
                const double low = t->node[child].low[a], high = t->node[child].high[a];
                node->low[a] = low < node->low[a] ? low : node->low[a];
                node->high[a] = high > node->high[a] ? high : node->high[a];
            }
        }
    }
    node->skip = t->nodes;
}

/* Returns an empty tree with room for the mesh; NULL when out of memory. */
static inline dem__tree *dem__new_tree(const dem_allocator *a, ptrdiff_t vertices, ptrdiff_t triangles) {
    const size_t v = (size_t)vertices, k = (size_t)triangles;
    const size_t bytes =
        sizeof(dem__tree) + (v + k) * sizeof(dem_vec) + k * sizeof(dem__node) + 3 * k * sizeof(int32_t);
    dem__tree *t = (dem__tree *)a->fn(a->user, NULL, 0, bytes);
    if (!t) return NULL;
    memset(t, 0, bytes);
    t->bytes = bytes;
    t->vertices = (int32_t)vertices;
    t->vertex = (dem_vec *)(void *)(t + 1);
    t->normal = t->vertex + v;
    t->node = (dem__node *)(void *)(t->normal + k);
    t->corner = (int32_t *)(void *)(t->node + k);
    return t;
}

/* Returns twice the area of a triangle as a vector along its normal. The two shorter edges make it accurate for
   slivers. */
static inline dem_vec dem__area(dem_vec a, dem_vec b, dem_vec c) {
    const dem_vec ab = dem__sub(b, a), bc = dem__sub(c, b), ca = dem__sub(a, c);
    const double x = dem__dot(ab, ab), y = dem__dot(bc, bc), z = dem__dot(ca, ca);
    if (x >= y && x >= z) return dem__cross(bc, ca);
    return y >= z ? dem__cross(ca, ab) : dem__cross(ab, bc);
}

/* Returns whether a triangle has an area beyond the rounding of its corners. unit: its normal. */
static inline int dem__has_area(dem_vec a, dem_vec b, dem_vec c, dem_vec *unit) {
    const dem_vec n = dem__area(a, b, c), ab = dem__sub(b, a), ac = dem__sub(c, a), bc = dem__sub(c, b);
    double longest = dem__dot(ab, ab);
    longest = dem__dot(ac, ac) > longest ? dem__dot(ac, ac) : longest;
    longest = dem__dot(bc, bc) > longest ? dem__dot(bc, bc) : longest;
    return dem__length(n) > 1e-9 * longest && dem__unit(n, unit);
}

/* Builds the tree of the triangles that have an area. Returns NULL with *status DEM_OUT_OF_MEMORY, or DEM_BAD_ARGUMENT
   if there are none. */
static inline dem__tree *dem__make_tree(const dem_allocator *a, ptrdiff_t vertices, const dem_vec *vertex,
                                        ptrdiff_t triangles, const int32_t *corner, dem_status *status) {
    const size_t scratch = 2 * (size_t)triangles * sizeof(dem__keyed);
    dem_vec low = vertex[0], high = vertex[0], normal;
    ptrdiff_t n = 0;
    for (ptrdiff_t v = 0; v < vertices; v++) {
        for (int c = 0; c < 3; c++) {
            double *l = dem_axis_of(&low, c), *h = dem_axis_of(&high, c), x = dem_axis(vertex[v], c);
            *l = x < *l ? x : *l;
            *h = x > *h ? x : *h;
        }
    }
    *status = DEM_OUT_OF_MEMORY;
    dem__keyed *items = (dem__keyed *)a->fn(a->user, NULL, 0, scratch);
    if (!items) return NULL;
    for (int32_t k = 0; k < (int32_t)triangles; k++) {
        const dem_vec p[3] = {vertex[corner[3 * k]], vertex[corner[3 * k + 1]], vertex[corner[3 * k + 2]]};
        if (!dem__has_area(p[0], p[1], p[2], &normal)) continue;
        items[n].index = k;
        items[n].key = 0;
        for (int c = 0; c < 3; c++) {
            const double from = dem_axis(low, c), span = dem_axis(high, c) - from;
            const double x = (dem_axis(p[0], c) + dem_axis(p[1], c) + dem_axis(p[2], c)) / 3.0 - from;
            items[n].key |= dem__interleave(span > 0.0 ? (uint64_t)(dem__clamp(x / span, 0.0, 1.0) * 2097151.0) : 0)
                            << c;
        }
        n++;
    }
    dem__tree *t = n > 0 ? dem__new_tree(a, vertices, n) : NULL;
    if (n == 0) *status = DEM_BAD_ARGUMENT;
    if (t) {
        dem__sort_keyed(items, items + n, n);
        memcpy(t->vertex, vertex, (size_t)vertices * sizeof *vertex);
        for (ptrdiff_t k = 0; k < n; k++) {
            const int32_t *from = &corner[3 * items[k].index];
            memcpy(&t->corner[3 * k], from, 3 * sizeof *from);
            dem__has_area(vertex[from[0]], vertex[from[1]], vertex[from[2]], &t->normal[k]);
        }
        t->triangles = (int32_t)n;
        dem__grow_node(t, 0, (int32_t)n);
        *status = DEM_OK;
    }
    a->fn(a->user, items, scratch, 0);
    return t;
}

/* Returns whether a mesh's numbers are valid. low, high: its bounding box. */
static inline int dem__is_mesh(const dem_mesh *m, dem_vec *low, dem_vec *high) {
    if (!m || !m->vertex || !m->triangle || m->vertices < 1 || m->triangles < 1 || m->vertices > INT32_MAX / 4 ||
        m->triangles > INT32_MAX / 4)
        return 0;
    *low = dem_vec3(HUGE_VAL, HUGE_VAL, HUGE_VAL), *high = dem__scale(-1.0, *low);
    for (ptrdiff_t k = 0; k < 3 * m->triangles; k++) {
        if (m->triangle[k] < 0 || m->triangle[k] >= m->vertices) return 0;
    }
    for (ptrdiff_t k = 0; k < 3 * m->vertices; k++) {
        double *l = dem_axis_of(low, (int)(k % 3)), *h = dem_axis_of(high, (int)(k % 3)), x = m->vertex[k];
        if (!(fabs(x) < 1e50)) return 0; /* so that squares of areas are finite */
        *l = x < *l ? x : *l;
        *h = x > *h ? x : *h;
    }
    return 1;
}
