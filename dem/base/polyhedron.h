/* Convex polyhedra: public types and functions. */
#pragma once
#include "law.h"

#define DEM_CORNERS_MAX 32                      /* corners of a core at most: a set of them fits into 32 bits */
#define DEM_FACES_MAX (2 * DEM_CORNERS_MAX - 4) /* by Euler's formula, if all are triangles */
#define DEM_EDGES_MAX (3 * DEM_CORNERS_MAX - 6)

/* A convex polyhedron with rounded edges and corners: all points within a radius of a core. Its flat faces are those of
   the polyhedron from which it was made; the core is that polyhedron, eroded by the radius. Volume, centroid and
   inertia are those of the sharp polyhedron. Corners and planes are relative to the centroid, along the axes of the
   frame in which the polyhedron was given; in the copy that a world keeps (dem_get_shape), along the principal axes.
   Made by the functions below. */
typedef struct dem_convex {
    int corners, edges, faces;
    int is_box;       /* 1: the core is a box along the principal axes with half lengths `half` */
    int along_axes;   /* 1: corners and planes lie along the principal axes; 0: as they were given */
    int given;        /* corners of the polyhedron from which it was made */
    double radius;    /* of rounding [m] */
    double deviation; /* of its surface from that of the given polyhedron with this rounding, at most [m]; 0: none */
    double reach;     /* from the centroid to the farthest point [m] */
    double volume;    /* [m3] */
    double moment[3]; /* principal moments of inertia over density [m5] */
    int springs;      /* greatest number of corners of a face: together they have the stiffness k of a pair */
    double rate;      /* square of the highest frequency of a contact of a face or a corner, over k/m [-] */
    dem_vec half;     /* of a box [m] */
    dem_vec centroid; /* in the frame in which the polyhedron was given [m] */
    dem_vec
        axis[3]; /* principal axes in that frame, right-handed; for equal moments, those closest to the frame's axes */
    double corner[DEM_CORNERS_MAX][3];      /* of the core [m] */
    double plane[DEM_FACES_MAX][4];         /* of the core: outward normal and distance from the centroid [m] */
    uint8_t face_start[DEM_FACES_MAX + 1];  /* where a face's corners begin in face_corner */
    uint8_t face_corner[2 * DEM_EDGES_MAX]; /* counterclockwise from outside */
    uint8_t edge[DEM_EDGES_MAX][2];         /* corners of an edge */
    uint8_t edge_face[DEM_EDGES_MAX]
                     [2]; /* its faces; it runs along the corners of the first and against those of the second */
} dem_convex;

/* Makes a polyhedron from its corners, in any order. n: 4 or more; corners: shape [n][3] [m]; rounding: radius over the
   smallest distance between a face and the corner opposite to it [-], 0.001 .. 0.4; 0.03 is a good value. Volume,
   centroid and moments are those of all corners. A core of more than DEM_CORNERS_MAX corners (where more than three
   faces meet, it has more corners than the polyhedron) is replaced by a similar one; `deviation` tells how close it is.
   DEM_BAD_ARGUMENT, with the cause in *reason (may be NULL): a number that is not finite or out of range, corners in
   one plane, a point that is no corner (it lies inside, in a face, on an edge or on another), or a rounding that leaves
   no core. DEM_OUT_OF_MEMORY: only for more than DEM_CORNERS_MAX corners, here or of the core. */
DEM_API dem_status dem_make_convex(dem_convex *shape, int n, const double *corners, double rounding,
                                   const char **reason);
/* Makes a polyhedron from the convex hull of points, for instance of a scan, or of the corners of an STL file. points:
   shape [n][3] [m], at least 4, with at most 65536 on the hull; points inside do not matter. tolerance: of the surface,
   over the diameter of the sphere of the same volume [-], 0 .. 0.2: the core has as few corners as keep `deviation`
   below it, and is refused if DEM_CORNERS_MAX do not suffice; 0: as close as these allow. allocator: for working
   memory; NULL: realloc and free. Otherwise as dem_make_convex. */
DEM_API dem_status dem_make_hull(dem_convex *shape, ptrdiff_t n, const double *points, double rounding,
                                 double tolerance, const dem_allocator *allocator, const char **reason);
/* Makes a box with these edge lengths along its axes [m] > 0. rounding, reason: as in dem_make_convex. */
DEM_API dem_status dem_make_brick(dem_convex *shape, dem_vec lengths, double rounding, const char **reason);
/* Makes a round tablet, lens or cylinder about the z axis. diameter, height: overall [m] > 0; band: height of its
   straight side [m]. If it equals `height`, the shape is a cylinder; if it is less, the shape has caps that are parts
   of balls, half balls at most; 0 makes a lens. The polyhedron has 16 sides and the volume of the round body. With caps
   the core is reduced: `deviation` tells by how much. rounding, reason: as in dem_make_convex. */
DEM_API dem_status dem_make_tablet(dem_convex *shape, double diameter, double height, double band, double rounding,
                                   const char **reason);
/* Makes a grain of gravel: corners on an ellipsoid with half axes in the ratio 1 : elongation : elongation flatness
   along x, y, z, spread evenly and then perturbed. diameter: of the sphere of the same volume [m] > 0; elongation,
   flatness: 0.1 .. 1 [-]; corners: 6 .. 300; seed: any number; each makes another grain. rounding, reason: as in
   dem_make_convex. */
DEM_API dem_status dem_make_gravel(dem_convex *shape, double diameter, double elongation, double flatness, int corners,
                                   uint64_t seed, double rounding, const char **reason);
/* Makes a polyhedron from a convex closed surface of up to 4000 triangles. Also refuses an edge that does not have two
   triangles, and a corner outside a triangle's plane. Triangles in one plane make one face. */
DEM_API dem_status dem_make_convex_mesh(dem_convex *shape, const dem_mesh *mesh, double rounding, const char **reason);

/* Adds a shape to a world, which keeps a copy turned to the principal axes. Returns its number from 0 on, or minus a
   dem_status. */
DEM_API int dem_add_shape(dem_world *world, const dem_convex *shape);
/* Adds n polyhedra of a shape at rest. centres: of mass, shape [n][3] [m]; orientations: [n][4], quaternions of any
   length but 0, scalar first, from the frame in which the shape was given to the world's; NULL: as it was given.
   Otherwise as dem_add_spheres. Each is one particle, whose radius is that of the sphere around it. A contact is a
   point: a corner at the other body, or two edges that cross. At each point the pair's law acts between spheres with
   the rounding radii (a sphere has its own). All points of a pair share its spring and its dashpot, so that a face is
   one contact. Weights of points let force pass from edges to corners without a jump (docs/dem_convex.md). Runs need
   DEM_FRICTION (otherwise DEM_POLYHEDRON; a friction of 0 is allowed). Overlaps must stay below the sum of the radii:
   cores that overlap are pushed apart, too, but their normals may jump. Corners, edges and faces touch walls of every
   kind. Links of polyhedra are refused with DEM_POLYHEDRON. */
DEM_API dem_status dem_add_convex(dem_world *world, int shape, ptrdiff_t n, const double *centres,
                                  const double *orientations, int material, int group);

/* Makes a body of n convex parts, and adds their shapes to a world. n: 1 .. DEM_PARTS_MAX; parts: [n], made by
   dem_make_hull and its like; places: [n][3], of the origin of the frame in which a part was given, in the frame of the
   compound [m]; NULL: 0, for parts whose corners have one common origin; orientations: [n][4], quaternions of any
   length but 0, scalar first, from a part's frame to the compound's; NULL: none is turned. Volume, centre of mass and
   moments are sums over the parts, which should not overlap: what two have in common counts twice. Parts may lie apart.
   All contacts of two bodies share the law of one pair, so a face of several parts is one contact. DEM_BAD_ARGUMENT,
   with the cause in *reason (may be NULL): a number that is not finite, a part that is no polyhedron, or whose centroid
   lies in another part. DEM_TOO_MANY beyond DEM_PARTS_MAX. DEM_OUT_OF_MEMORY. */
DEM_API dem_status dem_make_compound(dem_world *world, int n, const dem_convex *parts, const double *places,
                                     const double *orientations, dem_compound *compound, const char **reason);
/* Adds n bodies at rest of a compound that was made with this world, or with the one whose save it was loaded from.
   centres: of mass, shape [n][3] [m]. Each part is a particle, as each sphere of a clump is: they are consecutive, move
   as one and do not touch each other; each has the mass of the body. All else as in dem_add_convex. */
DEM_API dem_status dem_add_compounds(dem_world *world, ptrdiff_t n, const dem_compound *compound, const double *centres,
                                     const double *orientations, int material, int group);
/* Returns the orientation of the polyhedron of particle i, from the frame in which its shape was given; for a part of a
   compound it differs from that of the body, which dem_orientation returns. */
DEM_API dem_quaternion dem_shape_orientation(const dem_world *world, ptrdiff_t i);

DEM_API int dem_shape_of(const dem_world *world, ptrdiff_t i); /* number of its shape; -1: it has none */
DEM_API const dem_convex *dem_get_shape(const dem_world *world,
                                        int shape); /* owned by the world; NULL if there is none */
/* Counts the overlaps in the last step that are too deep: pairs of polyhedra whose cores overlapped, spheres whose
   centre was in a core, and walls that cut a core. It should be 0. */
DEM_API int64_t dem_core_overlaps(const dem_world *world);
/* Counts them over all steps since the world was made: two pairs for three steps are 6. It tells whether contacts were
   too soft at any time of a run. A save keeps it. */
DEM_API int64_t dem_core_overlap_steps(const dem_world *world);
