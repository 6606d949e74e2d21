/* A mesh from the facets of an STL file. Owns scratch memory while it works. Promises: on failure nothing is left
   allocated. */
#pragma once
#include "stl.h"

/* ---- from facets to a mesh ---- */

/* Working memory for making a mesh. */
typedef struct dem__mesh_builder {
    dem__facet *facets;
    ptrdiff_t n;
    dem__slot *slots; /* `capacity` of them */
    size_t capacity;
    int32_t *next; /* 3 n: the next vertex of a cell; later the corners of triangles without area */
    ptrdiff_t slivers;
    double weld,
        cell; /* distance up to which corners are one [m]; size of a grid cell [m], 0: only equal coordinates are one */
} dem__mesh_builder;

static inline uint64_t dem__key_of_cell(const dem__mesh_builder *s, const double *cell) {
    uint64_t key = 0, bits;
    for (int a = 0; a < 3; a++) {
        const double v = (s->cell > 0.0 ? floor(cell[a] / s->cell) : cell[a]) + 0.0; /* no -0 */
        memcpy(&bits, &v, sizeof bits);
        key = dem__scramble(key * 3 + bits + 1);
    }
    return key | 1;
}

/* Returns the vertex at a place: an earlier one within `weld`, otherwise a new one. Vertices are chained from the cells
   of a grid, which are four times as wide as `weld`, so that few fit into one cell. */
static inline int32_t dem__weld(dem__mesh_builder *s, dem_vec *vertex, ptrdiff_t *count, dem_vec p) {
    for (int side = 0; side < (s->cell > 0.0 ? 8 : 1); side++) {
        double place[3];
        int seen = 0;
        for (int a = 0; a < 3; a++) {
            const double low = dem_axis(p, a) - s->weld, high = dem_axis(p, a) + s->weld;
            place[a] = side >> a & 1 ? high : low;
            seen |= (side >> a & 1) && s->cell > 0.0 &&
                    floor(low / s->cell) == floor(high / s->cell); /* one cell for both sides */
        }
        if (seen) continue;
        const dem__slot *slot = dem__find_slot(s->slots, s->capacity, dem__key_of_cell(s, place));
        for (int32_t v = slot->key ? slot->value : -1; v >= 0; v = s->next[v]) {
            if (dem__length(dem__sub(vertex[v], p)) <= s->weld) return v;
        }
    }
    const int32_t fresh = (int32_t)(*count)++;
    const double own[3] = {p.x, p.y, p.z};
    const uint64_t key = dem__key_of_cell(s, own);
    dem__slot *slot = dem__find_slot(s->slots, s->capacity, key);
    vertex[fresh] = p;
    s->next[fresh] = slot->key ? slot->value : -1;
    slot->key = key;
    slot->value = fresh;
    return fresh;
}

static inline dem__slot *dem__stl_edge(dem__mesh_builder *s, int32_t a, int32_t b) {
    const uint64_t low = (uint64_t)(a < b ? a : b), high = (uint64_t)(a < b ? b : a);
    dem__slot *slot = dem__find_slot(s->slots, s->capacity, low << 32 | high);
    slot->key = low << 32 | high; /* never 0, as a < b */
    return slot;
}

/* Counts the three edges of a triangle. */
static inline void dem__count_edges_of(dem__mesh_builder *s, const int32_t *t) {
    for (int e = 0; e < 3; e++) {
        const int32_t a = t[e], b = t[(e + 1) % 3];
        dem__slot *slot = dem__stl_edge(s, a, b);
        if (a < b) slot->forward++;
        else slot->backward++;
    }
}

/* Returns how many edges of a triangle have exactly one other triangle, in the opposite direction. */
static inline int dem__closes(dem__mesh_builder *s, const int32_t *t) {
    int closed = 0;
    for (int e = 0; e < 3; e++) {
        const dem__slot *slot = dem__stl_edge(s, t[e], t[(e + 1) % 3]);
        const int32_t along = t[e] < t[(e + 1) % 3] ? slot->forward : slot->backward;
        closed += along == 0 && slot->forward + slot->backward == 1;
    }
    return closed;
}

/* Closes T-junctions, where one long edge lies on two short ones and there is no hole, with triangles without area. In
   a fan of these one closes after the other. Sixteen passes, forward and backward in turn, suffice for any order that a
   program writes. */
static inline void dem__close_junctions(dem__mesh_builder *s) {
    int changed = 1;
    for (int pass = 0; pass < 16 && changed; pass++) {
        changed = 0;
        for (ptrdiff_t k = 0; k < s->slivers; k++) {
            int32_t *t = &s->next[3 * (pass % 2 ? s->slivers - 1 - k : k)];
            if (t[0] < 0 || dem__closes(s, t) < 2) continue;
            dem__count_edges_of(s, t);
            t[0] = -1;
            changed = 1;
        }
    }
}

/* Scales the facets and drops those that are not finite. Returns how many are left; the report gets their bounding
   box. */
static inline ptrdiff_t dem__keep_finite(dem__mesh_builder *s, double scale, dem_stl_report *report) {
    dem_vec low = dem_vec3(HUGE_VAL, HUGE_VAL, HUGE_VAL), high = dem__scale(-1.0, low);
    ptrdiff_t kept = 0;
    for (ptrdiff_t k = 0; k < s->n; k++) {
        dem__facet f = s->facets[k];
        int finite = 1;
        for (int c = 0; c < 9; c++) {
            double *x = dem_axis_of(&f.corner[c / 3], c % 3);
            *x *= scale;
            finite &= fabs(*x) < 1e50;
        }
        report->not_finite += !finite;
        if (!finite) continue;
        s->facets[kept++] = f;
        for (int c = 0; c < 9; c++) {
            double *l = dem_axis_of(&low, c % 3), *h = dem_axis_of(&high, c % 3), x = dem_axis(f.corner[c / 3], c % 3);
            *l = x < *l ? x : *l;
            *h = x > *h ? x : *h;
        }
    }
    if (kept > 0) report->low = low, report->high = high;
    return kept;
}

/* Returns whether a triangle with the same three corners, in any order, came before. */
static inline int dem__is_duplicate(dem__mesh_builder *s, const int32_t *t) {
    const int32_t first = t[0] < t[1] ? (t[0] < t[2] ? t[0] : t[2]) : (t[1] < t[2] ? t[1] : t[2]);
    const int32_t last = t[0] > t[1] ? (t[0] > t[2] ? t[0] : t[2]) : (t[1] > t[2] ? t[1] : t[2]);
    const uint64_t middle = (uint64_t)t[0] + (uint64_t)t[1] + (uint64_t)t[2] - (uint64_t)first - (uint64_t)last;
    /* a key of three numbers, which two triangles share with a probability of 2^-64 */
    const uint64_t key =
        dem__scramble(dem__scramble((uint64_t)first + 1) + dem__scramble(middle + 1) * 3 + (uint64_t)last) | 1;
    dem__slot *slot = dem__find_slot(s->slots, s->capacity, key);
    if (slot->key) return 1;
    slot->key = key;
    return 0;
}

/* Keeps the triangles that have an area and are new; sums area and volume. */
static inline void dem__keep_triangles(dem__mesh_builder *s, dem_mesh *m, ptrdiff_t n, dem_stl_report *report) {
    const dem_vec *vertex = (const dem_vec *)(const void *)m->vertex;
    for (ptrdiff_t k = 0; k < n; k++) {
        const int32_t t[3] = {m->triangle[3 * k], m->triangle[3 * k + 1], m->triangle[3 * k + 2]};
        const dem_vec a = vertex[t[0]], b = vertex[t[1]], c = vertex[t[2]];
        const int corners = t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        dem_vec normal;
        if (!corners || !dem__has_area(a, b, c, &normal)) {
            report->degenerate++;
            if (corners) memcpy(&s->next[3 * s->slivers++], t, sizeof t);
            continue;
        }
        if (dem__is_duplicate(s, t)) {
            report->duplicate++;
            continue;
        }
        const dem_vec twice = dem__area(a, b, c), given = s->facets[k].normal;
        const double length = dem__length(given);
        if (dem__positive(length) && dem__dot(given, normal) < 0.5 * length) report->wrong_normals++;
        report->area += 0.5 * dem__length(twice);
        report->volume += dem__dot(dem__sub(a, report->low), twice) / 6.0;
        memcpy(&m->triangle[3 * m->triangles++], t, sizeof t);
    }
}

static inline void dem__count_edges(dem__mesh_builder *s, const dem_mesh *m, dem_stl_report *report) {
    for (ptrdiff_t k = 0; k < m->triangles; k++) dem__count_edges_of(s, &m->triangle[3 * k]);
    dem__close_junctions(s);
    for (size_t k = 0; k < s->capacity; k++) {
        const int32_t f = s->slots[k].forward, b = s->slots[k].backward;
        report->open_edges += f + b == 1;
        report->nonmanifold += f + b > 2;
        report->inconsistent += f + b == 2 && f != b;
    }
}

/* Fills an empty mesh, whose arrays have room, and the report. */
static inline void dem__make_mesh(dem_mesh *m, dem__mesh_builder *s, double scale, double weld,
                                  dem_stl_report *report) {
    const ptrdiff_t n = dem__keep_finite(s, scale, report);
    if (n == 0) return;
    const double size = dem__length(dem__sub(report->high, report->low));
    s->weld = weld < size ? weld : size;
    s->cell = 4.0 * s->weld;
    memset(s->slots, 0, s->capacity * sizeof *s->slots);
    for (ptrdiff_t k = 0; k < 3 * n; k++)
        m->triangle[k] = dem__weld(s, (dem_vec *)(void *)m->vertex, &m->vertices, s->facets[k / 3].corner[k % 3]);
    memset(s->slots, 0, s->capacity * sizeof *s->slots);
    dem__keep_triangles(s, m, n, report);
    memset(s->slots, 0, s->capacity * sizeof *s->slots);
    dem__count_edges(s, m, report);
}

DEM_API dem_status dem_read_stl(const void *bytes, size_t size, double scale, double weld,
                                const dem_allocator *allocator, dem_mesh *mesh, dem_stl_report *report) {
    const unsigned char *text = (const unsigned char *)bytes;
    dem_stl_report found;
    dem_allocator memory;
    dem__mesh_builder shop;
    if (!mesh) return DEM_BAD_ARGUMENT;
    memset(mesh, 0, sizeof *mesh);
    memset(&found, 0, sizeof found);
    memset(&shop, 0, sizeof shop);
    if (report) *report = found;
    if ((size > 0 && !bytes) || !dem__positive(scale) || !dem__not_negative(weld)) return DEM_BAD_ARGUMENT;
    memory.fn = dem__default_allocator;
    memory.user = NULL;
    if (allocator) memory = *allocator;
    if (!memory.fn) return DEM_BAD_ARGUMENT;

    dem__count_facets(text, size, &found);
    if (report) *report = found;
    if (found.facets == 0) return DEM_BAD_DATA;
    if (found.facets > INT32_MAX / 12) return DEM_TOO_MANY;
    const size_t n = (size_t)found.facets;
    shop.n = found.facets;
    for (shop.capacity = 64; shop.capacity < 6 * n;) shop.capacity *= 2;
    const size_t scratch = n * sizeof(dem__facet) + shop.capacity * sizeof(dem__slot) + 3 * n * sizeof(int32_t);
    mesh->bytes = 3 * n * sizeof(dem_vec) + 3 * n * sizeof(int32_t);
    mesh->allocator = memory;
    mesh->block = memory.fn(memory.user, NULL, 0, mesh->bytes);
    shop.facets = mesh->block ? (dem__facet *)memory.fn(memory.user, NULL, 0, scratch) : NULL;
    if (!shop.facets) {
        dem_free_mesh(mesh);
        return DEM_OUT_OF_MEMORY;
    }
    shop.slots = (dem__slot *)(void *)(shop.facets + n);
    shop.next = (int32_t *)(void *)(shop.slots + shop.capacity);
    mesh->vertex = (double *)mesh->block;
    mesh->triangle = (int32_t *)(void *)(mesh->vertex + 9 * n);
    if (!found.binary) dem__read_text(text, size, shop.facets, &found);
    for (size_t k = 0; k < n && found.binary; k++) dem__read_facet(text, k, &shop.facets[k]);
    dem__make_mesh(mesh, &shop, scale, weld, &found);
    memory.fn(memory.user, shop.facets, scratch, 0);
    if (report) *report = found;
    if (mesh->triangles > 0) return DEM_OK;
    dem_free_mesh(mesh);
    return DEM_BAD_DATA;
}

DEM_API void dem_free_mesh(dem_mesh *mesh) {
    if (!mesh) return;
    if (mesh->block) mesh->allocator.fn(mesh->allocator.user, mesh->block, mesh->bytes, 0);
    memset(mesh, 0, sizeof *mesh);
}
