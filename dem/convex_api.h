/* ---- convex polyhedra ---- */
/* Convex polyhedra as a user sees them: types and functions.
   Relies on types.h.
   May be changed here alone: comments. */

#define DEM_CORNERS_MAX 32                      /* of a polyhedron: a set of corners fits into 32 bits */
#define DEM_FACES_MAX (2 * DEM_CORNERS_MAX - 4) /* Euler, as triangles */
#define DEM_EDGES_MAX (3 * DEM_CORNERS_MAX - 6)

/* A convex polyhedron with rounded edges and corners: a core, and all that lies within a radius of it. The outer faces are those of the
   polyhedron that it was made of; the core is that polyhedron, eroded. Volume, centroid and inertia are those of the sharp polyhedron.
   Lengths are in the frame of the principal axes, from the centroid. Made by the three functions below. */
typedef struct dem_convex {
    int corners, edges, faces;
    int is_box;                        /* 1: the core is a box along the axes of half lengths `half` */
    double radius;                     /* of rounding [m] */
    double reach;                      /* from the centroid to the farthest point [m] */
    double volume;                     /* [m3] */
    double moment[3];                  /* principal moments of inertia over density [m5] */
    double share;                      /* of its mass that the outermost corner has in a hit, mean over directions [-] */
    dem_vec half;                      /* [m] */
    dem_vec centroid;                  /* in the frame that the polyhedron was given in [m] */
    dem_vec axis[3];                   /* the principal axes in that frame, right-handed; where moments are equal, those nearest to it */
    double corner[DEM_CORNERS_MAX][3]; /* of the core [m] */
    double plane[DEM_FACES_MAX][4];    /* of the core: outward normal and distance from the centroid [m] */
    uint8_t face_start[DEM_FACES_MAX + 1];  /* where a face's corners begin in face_corner */
    uint8_t face_corner[2 * DEM_EDGES_MAX]; /* counterclockwise from outside */
    uint8_t edge[DEM_EDGES_MAX][2];         /* corners of an edge */
    uint8_t edge_face[DEM_EDGES_MAX][2];    /* its faces: it runs with the corners of the first, against those of the second */
} dem_convex;

/* Makes a polyhedron from its corners, in any order. n: 4 .. DEM_CORNERS_MAX; corners: shape [n][3] [m]; rounding: radius over the smallest
   distance of a face from the corner opposite to it [-], 0.001 .. 0.4; 0.03 is a good one. DEM_BAD_ARGUMENT, with *reason (may be NULL)
   saying why: a number that is not finite or out of range, corners in one plane, a point that is no corner (it lies inside, in a face, on
   an edge or on another), or a core of more than DEM_CORNERS_MAX corners (where over three faces meet, it may have more of them). */
DEM_API dem_status dem_make_convex(dem_convex *shape, int n, const double *corners, double rounding, const char **reason);
/* A box of these lengths along its axes [m] > 0. */
DEM_API dem_status dem_make_brick(dem_convex *shape, dem_vec lengths, double rounding, const char **reason);
/* From a closed surface of triangles that is convex: refused besides if an edge has not two triangles, or a corner lies outside of a
   triangle's plane. Triangles in one plane make one face. */
DEM_API dem_status dem_make_convex_mesh(dem_convex *shape, const dem_mesh *mesh, double rounding, const char **reason);

/* Adds a shape to a world; returns its number from 0 on, or minus a dem_status. It is copied, and stays. */
DEM_API int dem_add_shape(dem_world *world, const dem_convex *shape);
/* Adds n polyhedra of a shape at rest. centres: of mass, shape [n][3] [m]; orientations: [n][4], quaternions of any length but 0, scalar
   first, from the shape's principal axes to the world's; NULL: none is turned. Else as dem_add_spheres. Each is one particle, whose radius
   is that of the sphere around it.

   A contact is a point: a corner at the other body, or two edges that cross. All are the pair's law between spheres of the rounding radii
   (a sphere's own) there, with `share` of a polyhedron's mass for the dashpot; so a face on a face has as many springs as points. Points
   have weights, so that force passes from edges to corners without a jump (docs/dem_convex.md). Runs need DEM_FRICTION (else
   DEM_POLYHEDRON; a coefficient of 0 takes it out). Overlaps must stay below the sum of the radii: cores that overlap are pushed apart,
   too, but their normals may jump. Walls are touched by corners: right where a wall is flat or hollow there; what the edges of a
   polyhedron do at wires, rims and convex edges of a wall is not computed. Links of polyhedra are refused with DEM_POLYHEDRON. */
DEM_API dem_status dem_add_convex(dem_world *world, int shape, ptrdiff_t n, const double *centres, const double *orientations, int material,
                                  int group);
DEM_API int dem_shape_of(const dem_world *world, ptrdiff_t i);              /* number of its shape; -1: it has none */
DEM_API const dem_convex *dem_get_shape(const dem_world *world, int shape); /* the world's; NULL if it is not there */
DEM_API int64_t dem_core_overlaps(const dem_world *world);                  /* pairs whose cores overlapped in the last step: 0 is right */
