/* The triangles of a mesh, in a tree of boxes. walls/mesh_tree.h makes it, walls/mesh_touch.h searches it. */
#pragma once
#include "types.h"

/* A node of the tree. */
typedef struct dem__node {
    double low[3], high[3];
    int32_t skip, first, count; /* count: triangles of a leaf, else 0 */
} dem__node;
enum { DEM__LEAF = 4 };

/* Flags of entry `at` of dem__mesh_edges: of an edge, and of the corner at which it begins. */
enum {
    DEM__EDGE = 1,     /* a sharp edge, which protrudes on one side, or a rim */
    DEM__RIM = 2,      /* edge of one triangle, or of more than two: can be touched from all around */
    DEM__CORNER = 4,   /* the corner is sharp, and this is its entry */
    DEM__FROM_END = 8, /* the edge begins at a sharp corner */
    DEM__TO_END = 16   /* the edge ends at one */
};

/* Sharp edges and corners of a mesh. Entry 3 k + c is the edge of triangle k from its corner c, and that corner. Edges
   and corners that triangles share have one entry. */
typedef struct dem__mesh_edges {
    size_t bytes;
    dem_vec *outward; /* of an edge: direction away from both of its faces; 0 for a rim */
    dem_vec *tip;     /* of a corner: direction away from all of its edges; 0 at a rim */
    uint8_t *kind;    /* DEM__EDGE, .. */
} dem__mesh_edges;

/* A mesh's triangles in the wall's own frame, in the order of the leaves of a tree of boxes. Its nodes are in
   depth-first order; `skip` is the next node outside this subtree. */
typedef struct dem__tree {
    size_t bytes;
    dem__mesh_edges *edges; /* sharp edges and corners; NULL until there are polyhedra */
    int32_t vertices, triangles, nodes;
    dem_vec *vertex, *normal;
    int32_t *corner; /* [triangles][3] */
    dem__node *node;
} dem__tree;
