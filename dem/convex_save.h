/* ------------------------------------------------------------------------------------ >>convex_save */
/* Shapes in a saved world: their fields, and whether loaded ones are sound.
   Relies on records.h for what a row means.
   May be changed here alone: what is checked. */
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
        DEM__DOUBLES("shape.share", c->share, s),
        DEM__DOUBLES("shape.half", c->half, s),
        DEM__DOUBLES("shape.centroid", c->centroid, s),
        DEM__DOUBLES("shape.axis", c->axis, s),
        DEM__DOUBLES("shape.corner", c->corner, s),
        DEM__DOUBLES("shape.plane", c->plane, s),
        {"shape.face_start", c->face_start, s, DEM_FACES_MAX + 1, 1},
        {"shape.face_corner", c->face_corner, s, 2 * DEM_EDGES_MAX, 1},
        {"shape.edge", c->edge, s, 2 * DEM_EDGES_MAX, 1},
        {"shape.edge_face", c->edge_face, s, 2 * DEM_EDGES_MAX, 1},
    };
    memcpy(field, fields, sizeof fields);
    return (int)(sizeof fields / sizeof *fields);
}

/* Returns whether the tables of a shape agree with each other, and its numbers are such as the code relies on. */
static inline int dem__is_sound_shape(const dem_convex *c) {
    if (c->corners < 4 || c->corners > DEM_CORNERS_MAX || c->edges < 6 || c->edges > DEM_EDGES_MAX || c->faces < 4 ||
        c->faces > DEM_FACES_MAX)
        return 0;
    int sound = dem__positive(c->radius) && dem__positive(c->reach) && dem__positive(c->volume) && c->share > 0.0 && c->share <= 1.0 &&
                c->face_start[0] == 0 && c->face_start[c->faces] == 2 * c->edges;
    for (int k = 0; k < 3; k++) sound &= dem__positive(c->moment[k]);
    for (int k = 0; k < 3 * c->corners; k++) sound &= fabs(c->corner[k / 3][k % 3]) <= c->reach;
    for (int k = 0; k < 4 * c->faces; k++) sound &= fabs(c->plane[k / 4][k % 4]) <= (k % 4 < 3 ? 1.0 + 1e-9 : c->reach);
    for (int k = 0; k < c->faces; k++) sound &= c->face_start[k] < c->face_start[k + 1];
    for (int k = 0; k < 2 * c->edges; k++) {
        sound &= c->face_corner[k] < c->corners && c->edge[k / 2][k % 2] < c->corners && c->edge_face[k / 2][k % 2] < c->faces;
    }
    return sound;
}

/* Returns whether particle i is what its shape, if it has one, needs. */
static inline int dem__is_sound_polyhedron(const dem_world *w, ptrdiff_t i) {
    const dem__convex_state *convex = &w->engine->convex;
    if (convex->shapes == 0 || convex->shape_of[i] == 0) return 1;
    const dem__rigid *r = dem__rigid_of(w, i);
    return convex->shape_of[i] > 0 && convex->shape_of[i] <= convex->shapes && r && r->pieces == 1;
}
