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
