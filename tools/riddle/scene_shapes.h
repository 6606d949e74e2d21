/* scene_shapes.h: the clumps, convex polyhedra and compounds of a scene file. */
#ifndef RIDDLE_SCENE_SHAPES_H
#define RIDDLE_SCENE_SHAPES_H

#include "scene.h"

/* Makes the shapes of the file. 0, or -1 with the message in the file. */
int scene_make_shapes(scene *s);
/* Finds the shape of a feed; *shape is NULL for spheres. */
int scene_shape_of(scene *s, const feed_def *feed, const body_shape **shape);
/* Adds the polyhedra and compounds of all sources to the scene's world, each class of sizes as a shape of its own. */
int scene_add_shapes(scene *s);
/* The width of the widest of its spheres, or of the polyhedron, over its diameter; 1 for spheres (NULL). */
double scene_widest(const body_shape *shape);
/* Says how well the spheres of a clump from a mesh fill it; the body's mass and moments are the mesh's. Returns 0 for
   another shape. */
int scene_say_fit(const scene *s, int shape, char *line, size_t size);
/* Whether it is a polyhedron or a compound. */
int scene_is_polyhedron(const body_shape *shape);
/* The number of particles of a body; 1 for spheres (NULL). */
int scene_pieces(const body_shape *shape);
int scene_has_polyhedra(const scene *s);
/* Adds one particle of a source and a diameter at rest to any world. */
dem_status scene_put(dem_world *world, const source *q, double diameter, dem_vec centre);

#endif
