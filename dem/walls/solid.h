/* Closed meshes and what is inside them. Reads meshes; owns scratch memory while it works. Promises: a mesh that is not
   closed has no inside; in a closed one only points within round-off of the surface depend on the division into
   triangles. */
#pragma once
#include "mesh.h"
#include "stl_mesh.h"

/* Returns whether the line from p along +z crosses a triangle. Both triangles of an edge test it with its ends in the
   same order, so that a line through an edge or a corner crosses the surface as often as a line beside it. */
static inline int dem__is_under(dem_vec a, dem_vec b, dem_vec c, dem_vec p) {
    const dem_vec corner[3] = {a, b, c};
    int inside = 0;
    for (int e = 0; e < 3; e++) {
        const dem_vec u = corner[e], v = corner[(e + 1) % 3];
        const int low = u.y <= p.y;
        if (low == (v.y <= p.y)) continue;
        const dem_vec from = low ? u : v, to = low ? v : u;
        inside ^= (to.x - from.x) * (p.y - from.y) > (p.x - from.x) * (to.y - from.y);
    }
    if (!inside) return 0;
    const dem_vec n = dem__area(a, b, c);
    return ((p.x - a.x) * n.x + (p.y - a.y) * n.y + (p.z - a.z) * n.z) * n.z < 0.0;
}

/* Returns whether p, in the wall's own frame, is inside a closed surface: a line from it crosses the surface an odd
   number of times. */
static inline int dem__is_inside_tree(const dem__tree *t, dem_vec p) {
    int inside = 0;
    for (int32_t b = 0; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (!(p.x >= node->low[0] && p.x <= node->high[0] && p.y >= node->low[1] && p.y <= node->high[1] &&
              p.z <= node->high[2])) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) {
            const int32_t *c = &t->corner[3 * k];
            inside ^= dem__is_under(t->vertex[c[0]], t->vertex[c[1]], t->vertex[c[2]], p);
        }
    }
    return inside;
}

/* Returns whether a point is inside a wall that is a solid body. */
static inline int dem__is_inside_wall(const dem_wall *w, dem_vec x) {
    return w->solid && dem__is_inside_tree(w->tree, dem__to_frame(w, dem__sub(x, w->position)));
}

static inline dem_vec dem__mesh_vertex(const dem_mesh *m, ptrdiff_t k, int corner) {
    const double *x = &m->vertex[3 * (ptrdiff_t)m->triangle[3 * k + corner]];
    return dem_vec3(x[0], x[1], x[2]);
}

static inline int dem__is_inside_mesh(const dem_mesh *m, dem_vec p) {
    int inside = 0;
    for (ptrdiff_t k = 0; k < m->triangles; k++)
        inside ^= dem__is_under(dem__mesh_vertex(m, k, 0), dem__mesh_vertex(m, k, 1), dem__mesh_vertex(m, k, 2), p);
    return inside;
}

/* Returns DEM_OK if every edge of a surface has an even number of triangles. Corners at the same place are one, even
   with different indices; triangles without area may close T-junctions. Otherwise returns DEM_BAD_ARGUMENT, also for a
   triangle that exists twice, DEM_TOO_MANY or DEM_OUT_OF_MEMORY. */
static inline dem_status dem__check_closed(const dem_allocator *memory, ptrdiff_t triangles, const dem_vec *vertex,
                                           const int32_t *corner) {
    const size_t n = (size_t)triangles;
    dem_stl_report report;
    dem__mesh_builder shop;
    dem_mesh mesh;
    int closed;
    memset(&report, 0, sizeof report);
    memset(&shop, 0, sizeof shop);
    memset(&mesh, 0, sizeof mesh);
    if (triangles > INT32_MAX / 12) return DEM_TOO_MANY;
    shop.n = triangles;
    for (shop.capacity = 64; shop.capacity < 6 * n;) shop.capacity *= 2;
    const size_t bytes =
        n * sizeof(dem__facet) + shop.capacity * sizeof(dem__slot) + 3 * n * sizeof(dem_vec) + 6 * n * sizeof(int32_t);
    shop.facets = (dem__facet *)memory->fn(memory->user, NULL, 0, bytes);
    if (!shop.facets) return DEM_OUT_OF_MEMORY;
    shop.slots = (dem__slot *)(void *)(shop.facets + n);
    mesh.vertex = (double *)(void *)(shop.slots + shop.capacity);
    shop.next = (int32_t *)(void *)(mesh.vertex + 9 * n);
    mesh.triangle = shop.next + 3 * n;
    memset(shop.facets, 0, n * sizeof(dem__facet));
    for (size_t k = 0; k < 3 * n; k++) shop.facets[k / 3].corner[k % 3] = vertex[corner[k]];
    dem__make_mesh(&mesh, &shop, 1.0, 0.0, &report);
    closed = mesh.triangles > 0 && report.duplicate == 0 && report.not_finite == 0;
    for (size_t k = 0; k < shop.capacity && closed; k++)
        closed = (shop.slots[k].forward + shop.slots[k].backward) % 2 == 0;
    memory->fn(memory->user, shop.facets, bytes, 0);
    return closed ? DEM_OK : DEM_BAD_ARGUMENT;
}

DEM_API dem_status dem_set_solid(dem_world *world, int wall, int solid) {
    if (dem__is_running(world)) return DEM_BUSY;
    if (dem__lacks_memory(world) || dem__lacks_wall(world, wall)) return DEM_BAD_ARGUMENT;
    dem_wall *w = &world->wall[wall];
    if (solid) {
        if (!w->tree) return dem__refuse(world, "wall: neither a mesh nor a box");
        const dem_status status =
            dem__check_closed(&world->def.allocator, w->tree->triangles, w->tree->vertex, w->tree->corner);
        if (status == DEM_BAD_ARGUMENT)
            return dem__refuse(world, "wall: not closed: an edge with an odd number of triangles, or a triangle twice");
        if (status != DEM_OK) return status;
    }
    w->solid = solid != 0;
    return DEM_OK;
}

DEM_API dem_region dem_mesh_region(const dem_mesh *mesh) {
    const dem_allocator memory = {dem__default_allocator, NULL};
    dem_region region;
    memset(&region, 0, sizeof region);
    region.kind = DEM_REGION_MESH;
    if (dem__is_mesh(mesh, &region.low, &region.high) &&
        dem__check_closed(&memory, mesh->triangles, (const dem_vec *)(const void *)mesh->vertex, mesh->triangle) ==
            DEM_OK)
        region.mesh = mesh;
    return region;
}

/* Returns the volume of a closed mesh [m3], whichever way all its triangles are oriented. */
static inline double dem__mesh_volume(const dem_mesh *m) {
    const dem_vec from = dem__mesh_vertex(m, 0, 0);
    double sum = 0.0;
    for (ptrdiff_t k = 0; k < m->triangles; k++) {
        const dem_vec a = dem__sub(dem__mesh_vertex(m, k, 0), from), b = dem__sub(dem__mesh_vertex(m, k, 1), from),
                      c = dem__sub(dem__mesh_vertex(m, k, 2), from);
        sum += dem__dot(a, dem__cross(b, c)) / 6.0;
    }
    return fabs(sum);
}
