/* Adding meshes and boxes. */
#pragma once
#include "follow.h"

static inline dem__feature dem__feature_meshes(void) {
    dem__feature f = dem__new_feature(DEM__MESHES_FEATURE);
    f.sorts = 1;
    f.follow = dem__follow_meshes;
    return f;
}

/* Adds a mesh. invalid, flat: what to tell of numbers out of range, and of triangles without area. */
static inline int dem__add_triangles(dem_world *world, int material, const dem_mesh *mesh, const char *invalid,
                                     const char *flat) {
    dem_wall wall;
    dem_vec low, high;
    dem_status status = dem__may_add_wall(world, material);
    memset(&wall, 0, sizeof wall);
    if (status != DEM_OK) return -(int)status;
    if (!dem__is_mesh(mesh, &low, &high)) return -(int)dem__refuse(world, invalid);
    if (world->walls >= DEM_WALLS_MAX) return -(int)DEM_TOO_MANY;
    wall.asked.origin = dem__scale(0.5, dem__add(low, high));
    dem__frame(&wall, dem_vec3(0, 0, 1), dem_vec3(1, 0, 0));

    const dem_allocator *a = &world->def.allocator;
    const size_t bytes = (size_t)mesh->vertices * sizeof(dem_vec);
    dem_vec *local = (dem_vec *)a->fn(a->user, NULL, 0, bytes);
    if (!local) return -(int)DEM_OUT_OF_MEMORY;
    for (ptrdiff_t k = 0; k < mesh->vertices; k++) {
        const double *x = &mesh->vertex[3 * k];
        local[k] = dem__sub(dem_vec3(x[0], x[1], x[2]), wall.asked.origin);
    }
    wall.tree = dem__make_tree(a, mesh->vertices, local, mesh->triangles, mesh->triangle, &status);
    a->fn(a->user, local, bytes, 0);
    if (!wall.tree) return -(int)(status == DEM_BAD_ARGUMENT ? dem__refuse(world, flat) : status);
    const int index = dem__add_wall(world, dem__triangles(), material, &wall);
    if (index < 0) dem__release(a, wall.tree, wall.tree->bytes);
    else dem__add_feature(world, dem__feature_meshes());
    return index;
}

DEM_API int dem_add_mesh(dem_world *world, int material, const dem_mesh *mesh) {
    return dem__add_triangles(world, material, mesh,
                              "mesh: no corners or triangles, an index out of range, or a coordinate of 1e50 m or more",
                              "mesh: no triangle has an area");
}

DEM_API int dem_add_box(dem_world *world, int material, dem_vec low, dem_vec high) {
    /* corner k: bit c chooses low or high of axis c */
    int32_t faces[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                         2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    double corners[24];
    dem_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    if (!(low.x < high.x && low.y < high.y && low.z < high.z))
        return -(int)dem__refuse(world, "low: a component is not below that of high");
    for (int k = 0; k < 24; k++) corners[k] = (k / 3 >> k % 3 & 1) ? dem_axis(high, k % 3) : dem_axis(low, k % 3);
    mesh.vertices = 8, mesh.vertex = corners;
    mesh.triangles = 12, mesh.triangle = faces;
    return dem__add_triangles(world, material, &mesh, "low, high: a component is not finite or 1e50 m or more",
                              "low, high: the faces have no area");
}
