/* Shapes in a saved world: their fields, and whether loaded ones are sound. */
#pragma once
#include "../records/groups.h"

#define DEM__SHAPE_OPTIONAL 2 /* fields at the end of the list that a save need not have */

static inline int dem__shape_fields(dem_convex *c, dem__saved_field *field) {
    const size_t s = sizeof *c;
    const dem__saved_field fields[] = {
        DEM__INTEGER("shape.corners", c->corners, s),
        DEM__INTEGER("shape.edges", c->edges, s),
        DEM__INTEGER("shape.faces", c->faces, s),
        DEM__INTEGER("shape.is_box", c->is_box, s),
        DEM__DOUBLES("shape.radius", c->radius, s),
        DEM__DOUBLES("shape.reach", c->reach, s),
        DEM__DOUBLES("shape.volume", c->volume, s),
        DEM__DOUBLES("shape.moment", c->moment, s),
        DEM__DOUBLES("shape.rate", c->rate, s),
        DEM__INTEGER("shape.springs", c->springs, s),
        DEM__DOUBLES("shape.half", c->half, s),
        DEM__DOUBLES("shape.centroid", c->centroid, s),
        DEM__DOUBLES("shape.axis", c->axis, s),
        DEM__DOUBLES("shape.corner", c->corner, s),
        DEM__DOUBLES("shape.plane", c->plane, s),
        {"shape.face_start", c->face_start, s, DEM_FACES_MAX + 1, 1},
        {"shape.face_corner", c->face_corner, s, 2 * DEM_EDGES_MAX, 1},
        {"shape.edge", c->edge, s, 2 * DEM_EDGES_MAX, 1},
        {"shape.edge_face", c->edge_face, s, 2 * DEM_EDGES_MAX, 1},
        DEM__INTEGER("shape.given", c->given, s),
        DEM__DOUBLES("shape.deviation", c->deviation, s),
    };
    memcpy(field, fields, sizeof fields);
    return (int)(sizeof fields / sizeof *fields);
}
