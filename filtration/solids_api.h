/* solids_api.h: solids at rest as a signed distance: woven wire cloth, beds of spheres and fibres, voxel images.
   Relies on base.h.
   May be changed here alone: comments. */

/* ==== >>solids: what stands in the fluid ==== */

/* A solid at rest, by functions of the caller, called in filtration_fluid_init and when spheres touch it. */
typedef struct filtration_solid {
    /* Signed distance from a point [m] to the surface [m], > 0 in the fluid. The sign and the zero must be right; elsewhere it may be
       smaller than the true distance, never larger. Points lie up to a voxel outside the box: periodic solids repeat themselves. NULL:
       no solid. */
    double (*distance)(const void *self, const double point[3]);
    /* Fraction of the way from a fluid point to a solid one at which the surface lies, above 0 .. 1 [-]. NULL: found from `distance`. */
    double (*cut)(const void *self, const double fluid[3], const double solid[3]);
    const void *self;
} filtration_solid;

/* The solids below keep their own data; filtration_..._solid() makes of it a filtration_solid that points to the data, which must outlive
   the fluid. */

/* Fraction of the way from a point in the fluid to one in the solid at which the surface lies, 0 .. 1 [-], by the distance alone, to 1e-9.
   For links shorter than what is between two surfaces. NaN if the ends do not lie on two sides. */
FILTRATION_API double filtration_solid_cut(const filtration_solid *solid, const double fluid[3], const double in_solid[3]);

typedef enum filtration_weave {
    FILTRATION_PLAIN_WEAVE, /* over one, under one: repeats after 2 wires */
    FILTRATION_TWILL_WEAVE  /* 2/2 twill: over two, under two: repeats after 4 wires */
} filtration_weave;

/* Woven wire cloth in a plane z = centre: round wires at x, y = (i + 1/2) pitch, pitch = wire + opening. Their axes go through wire / 2
   above and below the plane at crossings, straight between crossings on one side and as half a cosine wave between two sides. A cut
   across the axis, as it slopes, is a circle. Warp wires lie along y, over the weft at crossing (i, j) where (i + j) mod 4 < 2 (twill) or
   (i + j) mod 2 = 0 (plain). */
typedef struct filtration_cloth {
    double wire;    /* diameter [m] > 0 */
    double opening; /* between two wires [m] > 0 */
    filtration_weave weave;
    double centre; /* z of the plane [m] */
    double reach;  /* distances above it may be given too small [m] > 0; as large as the largest sphere's radius at least */
} filtration_cloth;

/* A cloth with a reach of 4 wires. BAD_ARGUMENT: wire, opening not > 0 and finite, centre not finite, unknown weave. */
FILTRATION_API filtration_status filtration_cloth_make(filtration_cloth *cloth, double wire, double opening, filtration_weave weave,
                                                       double centre);
/* Length after which it repeats along x and y [m]: a box of a periodic fluid is a multiple of it. */
static inline double filtration_cloth_period(const filtration_cloth *cloth) {
    return (cloth->wire + cloth->opening) * (cloth->weave == FILTRATION_TWILL_WEAVE ? 4.0 : 2.0);
}
/* Share of the plane not covered, seen from above: (opening / pitch)^2 [-]. */
static inline double filtration_cloth_open_area(const filtration_cloth *cloth) {
    const double ratio = cloth->opening / (cloth->wire + cloth->opening);
    return ratio * ratio;
}
static inline double filtration_cloth_thickness(const filtration_cloth *cloth) { return 2.0 * cloth->wire; } /* [m] */
/* Signed distance from its surface [m], > 0 outside; NaN for places a thousand million pitches away. */
FILTRATION_API double filtration_cloth_distance(const filtration_cloth *cloth, const double point[3]);
FILTRATION_API filtration_solid filtration_cloth_solid(const filtration_cloth *cloth);

/* Spheres and fibres (cylinders with round ends) in a box, periodic on chosen axes. */
typedef struct filtration_bed {
    ptrdiff_t n;
    double box[3];            /* [m] */
    int periodic[3];          /* 1: the bed repeats itself along this axis */
    double reach;             /* distances above it are given as it [m] */
    const double *a;          /* [n][3] centres, or first ends [m]; the caller's */
    const double *b;          /* [n][3] second ends [m]; NULL: spheres */
    const double *radius;     /* [n] [m] > 0 */
    filtration_memory memory; /* private from here on: which objects are near which part of the box */
    int cells[3];
    size_t entries;
    size_t *start;
    struct filtration__bed_entry *entry;
} filtration_bed;

/* Arrays are kept, not copied. memory NULL: malloc. After an error the bed is empty and may be freed. BAD_ARGUMENT: a number is not finite,
   a radius, an edge of the box or the reach not > 0. NO_MEMORY. */
FILTRATION_API filtration_status filtration_bed_init(filtration_bed *bed, ptrdiff_t n, const double *a, const double *b,
                                                     const double *radius, const double box[3], const int periodic[3], double reach,
                                                     const filtration_memory *memory);
FILTRATION_API void filtration_bed_free(filtration_bed *bed);
FILTRATION_API double filtration_bed_distance(const filtration_bed *bed, const double point[3]); /* as above [m] */
FILTRATION_API filtration_solid filtration_bed_solid(const filtration_bed *bed);

/* An image of cubes, as from a tomograph. */
typedef struct filtration_image {
    int n[3];                   /* cubes along x, y, z, each >= 1 */
    double edge;                /* of a cube [m] > 0 */
    double origin[3];           /* lower corner [m] */
    int periodic[3];            /* 1: the image repeats itself along this axis; else it is fluid outside */
    int reach;                  /* distances above it may be given too small [cubes] >= 1 */
    const unsigned char *solid; /* [n[2]][n[1]][n[0]], x fastest, nonzero: solid; the caller's */
} filtration_image;

/* BAD_ARGUMENT if a field is out of range. */
FILTRATION_API filtration_status filtration_image_check(const filtration_image *image);
FILTRATION_API double filtration_image_distance(const filtration_image *image, const double point[3]); /* as above [m] */
FILTRATION_API filtration_solid filtration_image_solid(const filtration_image *image);
