/* Meshes of triangles: thin sheets, or closed bodies. Spheres touch them at several places, which their contacts follow
   (meshes/follow.h). Polyhedra touch their sharp edges and corners. */
#pragma once
#include "mesh_touch.h"
#include "mesh_tree.h"

static inline int dem__touch_triangles(const dem_wall *w, dem_vec d, double radius, double limit, dem__touch *out,
                                       double *least) {
    return dem__touch_mesh(w, d, radius, limit < 0.0 ? limit : 0.0, limit, out, least);
}

/* Keys of an edge and its corner. Beyond 790 000 triangles keys repeat, but only far away, because triangles are in the
   order of the tree. */
enum { DEM__SHARP_KEYS = 1 + DEM__EDGE_KEYS, DEM__SHARP_EDGES_MAX = (1 << 30) / DEM__SHARP_KEYS };
DEM_INLINE int32_t dem__sharp_key(int32_t at) {
    return DEM_CORNERS_MAX * DEM__PLACE_DIRECTIONS + (int32_t)((int64_t)(at % DEM__SHARP_EDGES_MAX) * DEM__SHARP_KEYS);
}

/* Presents the sharp edges and corners of a triangle to a visitor. */
static inline void dem__show_triangle(const dem_wall *w, int32_t k, dem_vec d, dem__edge_visitor *v) {
    const dem__tree *t = w->tree;
    for (int32_t at = 3 * k; at < 3 * k + 3; at++) {
        const int kind = t->edges->kind[at];
        dem__wall_edge e;
        if (!(kind & (DEM__EDGE | DEM__CORNER))) continue;
        memset(&e, 0, sizeof e);
        e.key = dem__sharp_key(at);
        e.from = dem__sub(dem__from_frame(w, t->vertex[t->corner[at]]), d);
        if (kind & DEM__CORNER) v->corner(v, e.from, 0.0, dem__from_frame(w, t->edges->tip[at]), e.key);
        if (!(kind & DEM__EDGE)) continue;
        e.to = dem__sub(dem__from_frame(w, t->vertex[t->corner[at % 3 < 2 ? at + 1 : at - 2]]), d);
        e.ends = (kind & DEM__FROM_END ? 1 : 0) | (kind & DEM__TO_END ? 2 : 0);
        e.is_sided = !(kind & DEM__RIM), e.outward = dem__from_frame(w, t->edges->outward[at]);
        e.key++;
        v->edge(v, &e);
    }
}
static inline void dem__mesh_edges_near(const dem_wall *w, dem_vec centre, double reach, dem__edge_visitor *v) {
    const dem__tree *t = w->tree;
    const dem_vec d = dem__sub(centre, w->position), p = dem__to_frame(w, d);
    for (int32_t b = 0; b < (t->edges ? t->nodes : 0);) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, p, reach)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) dem__show_triangle(w, k, d, v);
    }
}

static inline const dem__wall_kind *dem__triangles(void) {
    static const dem__wall_kind row = {
        DEM_MESH,             /* kind */
        DEM__TRIANGULATED,    /* flags */
        NULL,                 /* is_sound: triangles are checked as they are read */
        dem__touch_triangles, /* touch */
        NULL,                 /* touch_element */
        NULL,                 /* other_elements */
        NULL,                 /* reach_round */
        NULL,                 /* normal_rate: a contact knows its normals */
        NULL,                 /* is_endless */
        NULL,                 /* closing */
        NULL,                 /* corners */
        dem__mesh_edges_near, /* edges */
        NULL                  /* crosses */
    };
    return &row;
}
