/* Solids at rest as a signed distance: woven wire cloth, beds of spheres and fibres, voxel images. */
#pragma once
#include "../base/base.h"

/* ==== >>solids: solids at rest in the fluid ==== */

/* A place at which a solid is near to a sphere. */
typedef struct filtration_near {
    double gap;       /* [m], < 0: overlap */
    double normal[3]; /* unit vector from the sphere's centre to the surface */
} filtration_near;

/* A solid at rest, described by functions of the caller. filtration_fluid_init calls them, and filtration_move where
   spheres touch the solid. */
typedef struct filtration_solid {
    /* Signed distance from a point to the surface [m], > 0 in the fluid. Its sign and its zero must be right; elsewhere
       it may be less than the true distance, never more. Points may lie up to a voxel outside the box, where periodic
       solids repeat. NULL: no solid. */
    double (*distance)(const void *self, const double point[3]);
    /* Fraction of the way from a fluid point to a solid one at which the surface lies [-], above 0 .. 1. NULL: computed
       from `distance`. */
    double (*cut)(const void *self, const double fluid[3], const double solid[3]);
    const void *self;
    /* Lists at most `most` places with a gap below `reach` to a sphere, one for each wire or body that it may touch.
       Returns how many. For filtration_move. NULL: the nearest place, from differences of `distance`. */
    int (*touch)(const void *self, const double centre[3], double radius, double reach, int most,
                 filtration_near *near);
} filtration_solid;

/* The solids below keep their own data. filtration_..._solid() returns a filtration_solid that points to these data,
   which must outlive the fluid. */

/* Returns the fraction of the way from a point in the fluid to one in the solid at which the surface lies [-], 0 ..
   1, from the distance alone, to 1e-9. The points must be closer than two surfaces. NaN if both ends are on the same
   side. */
FILTRATION_API double filtration_solid_cut(const filtration_solid *solid, const double fluid[3],
                                           const double in_solid[3]);

typedef enum filtration_weave {
    FILTRATION_PLAIN_WEAVE, /* over one, under one: repeats after 2 wires */
    FILTRATION_TWILL_WEAVE  /* 2/2 twill: over two, under two: repeats after 4 wires */
} filtration_weave;

/* Woven wire cloth in a plane z = centre, made of round wires at x, y = offset + (i + 1/2) pitch, pitch = wire +
   opening. At crossings their axes are wire / 2 above or below the plane. Between crossings on the same side they are
   straight, between crossings on opposite sides half a cosine wave. A cross-section perpendicular to the sloping axis
   is a circle. Warp wires lie along y, above the weft at crossing (i, j) if (i + j) mod 4 < 2 (twill) or (i + j) mod 2
   = 0 (plain). */
typedef struct filtration_cloth {
    double wire;    /* diameter [m] > 0 */
    double opening; /* between two wires [m] > 0 */
    filtration_weave weave;
    double centre; /* z of the plane [m] */
    double reach;  /* distances above this may be returned too small [m] > 0; at least the largest sphere's radius */
    double offset[2]; /* shift of the weave along x, y [m]; finite. Coarse voxels resolve a different cloth at each
                         shift */
} filtration_cloth;

/* Makes a cloth with a reach of 4 wires and no offset. BAD_ARGUMENT: wire or opening not > 0 and finite, centre not
   finite, unknown weave. */
FILTRATION_API filtration_status filtration_cloth_make(filtration_cloth *cloth, double wire, double opening,
                                                       filtration_weave weave, double centre);
/* Returns the length after which the cloth repeats along x and y [m]. A periodic box must be a multiple of it. */
static inline double filtration_cloth_period(const filtration_cloth *cloth) {
    return (cloth->wire + cloth->opening) * (cloth->weave == FILTRATION_TWILL_WEAVE ? 4.0 : 2.0);
}
/* Returns the open fraction of the plane in plan view: (opening / pitch)^2 [-]. */
static inline double filtration_cloth_open_area(const filtration_cloth *cloth) {
    const double ratio = cloth->opening / (cloth->wire + cloth->opening);
    return ratio * ratio;
}
static inline double filtration_cloth_thickness(const filtration_cloth *cloth) { return 2.0 * cloth->wire; } /* [m] */
/* Returns the signed distance from its surface [m], > 0 outside; NaN for points 1e9 pitches away. */
FILTRATION_API double filtration_cloth_distance(const filtration_cloth *cloth, const double point[3]);
FILTRATION_API filtration_solid filtration_cloth_solid(const filtration_cloth *cloth);

/* Spheres and fibres (cylinders with round ends) in a box, which may be periodic along its axes. */
typedef struct filtration_bed {
    ptrdiff_t n;
    double box[3];            /* [m] */
    int periodic[3];          /* 1: the bed repeats itself along this axis */
    double reach;             /* distances above this are returned as this [m] */
    const double *a;          /* [n][3] centres, or first ends [m]; the caller's */
    const double *b;          /* [n][3] second ends [m]; NULL: spheres */
    const double *radius;     /* [n] [m] > 0 */
    filtration_memory memory; /* private from here on: the objects near each part of the box */
    int cells[3];
    size_t entries;
    size_t *start;
    struct filtration__bed_entry *entry;
} filtration_bed;

/* Makes a bed. The arrays are kept, not copied. memory NULL: malloc. After an error the bed is empty and may be freed.
   BAD_ARGUMENT: a number is not finite; a radius, an edge of the box or the reach is not > 0. NO_MEMORY. */
FILTRATION_API filtration_status filtration_bed_init(filtration_bed *bed, ptrdiff_t n, const double *a, const double *b,
                                                     const double *radius, const double box[3], const int periodic[3],
                                                     double reach, const filtration_memory *memory);
FILTRATION_API void filtration_bed_free(filtration_bed *bed);
FILTRATION_API double filtration_bed_distance(const filtration_bed *bed, const double point[3]); /* as above [m] */
FILTRATION_API filtration_solid filtration_bed_solid(const filtration_bed *bed);

/* A voxel image of cubes, as from tomography. */
typedef struct filtration_image {
    int n[3];                   /* cubes along x, y, z, each >= 1 */
    double edge;                /* of a cube [m] > 0 */
    double origin[3];           /* lower corner [m] */
    int periodic[3];            /* 1: the image repeats along this axis; 0: outside is fluid */
    int reach;                  /* distances above this may be returned too small [cubes] >= 1 */
    const unsigned char *solid; /* [n[2]][n[1]][n[0]], x fastest, nonzero: solid; the caller's */
} filtration_image;

/* Returns BAD_ARGUMENT if a field is out of range. */
FILTRATION_API filtration_status filtration_image_check(const filtration_image *image);
/* As above [m]. */
FILTRATION_API double filtration_image_distance(const filtration_image *image, const double point[3]);
FILTRATION_API filtration_solid filtration_image_solid(const filtration_image *image);
