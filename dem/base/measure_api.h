/* The public functions that measure, and those that save, declared and explained. */
#pragma once
#include "api.h"

/* ---- measuring: readers of a world, into arrays of the caller; DEM_BAD_ARGUMENT for what is not finite or out of
 * range ---- */

/* Stresses are positive where spheres push. First index: component of force or momentum; second: direction in which it
   is carried. */
typedef struct dem_measure {
    ptrdiff_t count; /* spheres whose centres lie in the region */
    double mass;     /* of them [kg] */
    double
        solid_fraction;  /* volume of the spheres inside the region over its volume [-]; exact for box and sphere, to
                            1e-4 for a cylinder, to 1e-2 of what the surface of a mesh cuts; overlaps count twice */
    double coordination; /* mean number of contacts of these spheres [-] */
    dem_vec velocity;    /* mean by mass [m/s] */
    double granular_temperature; /* sum m |v - velocity|^2/(3 sum m) [m2/s2] */
    double contact_stress[3][3]; /* sum F l/V over contacts and links, where l is the part of the branch in the region
                                    [Pa]; the branch goes from centre to centre, or from a wall's point to the centre
                                    (Goldhirsch 2010, with the region as kernel) */
    double kinetic_stress[3][3]; /* sum m v' v'/V, v' = v - velocity [Pa] */
} dem_measure;
/* Measures a region. Along periodic axes it must not be longer than the box. Without a volume, quotients by it are NaN.
   With a mesh also DEM_OUT_OF_MEMORY. */
DEM_API dem_status dem_measure_region(const dem_world *world, const dem_region *region, dem_measure *measure);

/* A block of cells. n = 1 along an axis: no profile along it. */
typedef struct dem_cells {
    dem_vec low, high; /* corners of the block [m] */
    int n[3];          /* cells by axis, 1 .. 100000, their product < 2^30 */
    double width[3];   /* half width of the kernel by axis [m] >= 0; 0: none, a centre counts in its cell */
} dem_cells;
/* Coarse-grained fields: their means over a cell. */
typedef struct dem_field {
    double density;              /* [kg/m3] */
    dem_vec momentum;            /* per volume [kg/(m2 s)]; divided by density: velocity */
    double contact_stress[3][3]; /* [Pa] */
    double kinetic_stress[3][3]; /* with v' relative to the cell's own velocity [Pa] */
} dem_field;
/* Computes coarse-grained fields (Goldhirsch 2010, Granular Matter 12, 239, eqs 5, 6, 25, 30). The kernel is the
   product of 15/16 (1 - u^2)^2 by axis, u = distance/width. field: [n[2]][n[1]][n[0]]. Masses are integrated exactly
   over cells: their sum is that of the spheres if the block extends a width beyond them. Branches are integrated by
   Gauss's rule with 8 points. */
DEM_API dem_status dem_coarse_grain(const dem_world *world, const dem_cells *cells, dem_field *field);

/* How rigid bodies lie. */
typedef struct dem_order {
    ptrdiff_t bodies;    /* in the region */
    double tensor[3][3]; /* mean of (3 u u - 1)/2, u an axis of a body; NaN without bodies */
    double parameter;    /* its largest eigenvalue [-]: 1, all axes are parallel; 0, they have no common direction */
    dem_vec director;    /* the common direction: a unit vector of arbitrary sign */
} dem_order;
/* Measures the order tensor of the clumps and polyhedra whose centres lie in a region (NULL: of all). axis: 0, 1, 2 for
   x, y, z of the frame in which their shapes were given. Without a common direction the parameter is about
   1/sqrt(bodies). DEM_BAD_ARGUMENT. */
DEM_API dem_status dem_measure_order(const dem_world *world, const dem_region *region, int axis, dem_order *order);

/* Counts contacts in `bins` equal bins from low to high, low < high, by force [N], overlap [m] or tangential force [N].
   Contacts without overlap do not count. count: [bins]. Returns how many lie outside, or minus a dem_status. */
typedef enum dem_quantity { DEM_CONTACT_FORCE, DEM_CONTACT_OVERLAP, DEM_CONTACT_TANGENTIAL_FORCE } dem_quantity;
DEM_API ptrdiff_t dem_histogram(const dem_world *world, dem_quantity quantity, double low, double high, int bins,
                                double *count);

/* Sums residence times in a region. Call it at intervals [s], which are its resolution. It follows ids < n. entered:
   [n] time of entering, NaN outside, NaN at first; stayed: [n] sum of the completed visits [s], 0 at first. Leaving by
   an exit counts at its own time. */
DEM_API dem_status dem_residence(const dem_world *world, const dem_region *region, ptrdiff_t n, double *entered,
                                 double *stayed);

/* Counts centres by cell: those of one group, and all. [n[2]][n[1]][n[0]] each; width is not used. */
DEM_API dem_status dem_count_in_cells(const dem_world *world, const dem_cells *cells, int group, double *of_group,
                                      double *of_all);
/* How well two species are mixed, from their numbers in samples: [samples] of one species, and of both. Empty samples
   do not count. All NaN if one species is missing, or a number is negative or larger than that of both. */
typedef struct dem_mixing {
    double share;     /* share of the first species in all samples [-] */
    double separated; /* variance of its share over samples, weighted by their numbers, if each sample held one species
                         only [-] */
    double random;    /* the variance expected of a random mixture with these sizes of samples [-] */
    double variance;  /* the same, as it is [-] */
    double lacey; /* (separated - variance)/(separated - random): 0 separated, 1 on average in a random mixture (Lacey
                     1954) */
    double segregation; /* variance/separated: 1 separated (intensity of segregation, Danckwerts 1952) */
} dem_mixing;
DEM_API dem_mixing dem_mixing_of(ptrdiff_t samples, const double *of_group, const double *of_all);
/* Returns the number of contacts between a group and the others, over the number expected by chance: 0 separated, 1
   random. NaN without contacts. */
DEM_API double dem_unlike_contacts(const dem_world *world, int group);

/* Returns the volume of a ball within a box, its centre at the origin [m3] (closed form: Gauss-Bonnet for the sphere's
   part, then the divergence theorem). radius > 0, low <= high by axis; otherwise NaN. */
DEM_API double dem_ball_in_box(double radius, dem_vec low, dem_vec high);

/* Returns a hash of every bit of the particles' state and histories, and of controlled walls. */
DEM_API uint64_t dem_hash(const dem_world *world);

/* Saves everything that determines the future, little-endian, with version and checksum. Returns the size in bytes;
   writes only if capacity suffices (call it first with NULL, 0). Returns 0 for an invalid world, and from hooks, where
   a step is half done. */
DEM_API size_t dem_save(const dem_world *world, void *buffer, size_t capacity);
/* Makes a world from saved bytes. Its runs continue with the same bits, under a law with the name, version and number
   of states of the one that made the contacts (see dem_law). As for dem_init, *world must not be in use. allocator may
   be NULL. DEM_BAD_DATA, DEM_OUT_OF_MEMORY: then nothing is allocated. */
DEM_API dem_status dem_load(dem_world *world, const void *buffer, size_t size, const dem_allocator *allocator);
