/* The public functions, declared and explained. */
#pragma once
#include "law.h"

DEM_API const char *dem_status_text(dem_status status); /* never NULL */
/* Returns which argument was wrong, and why, in the last call that was to change this world and returned the status of
   a bad argument: a line such as "velocity: a component is not finite or above 1e80". Calls that succeed, fail with
   another status, or only read the world leave the text, so ask at once; dem_init and dem_load clear it. It is not
   saved. Never NULL; "" for a world without such a call, and for NULL; static storage. */
DEM_API const char *dem_error_text(const dem_world *world);

/* Returns 1 if this header, as built, computes the same bits as elsewhere: doubles are evaluated as doubles, and
   products are not fused with sums. Tested at run time. The code around the header is not tested: compile that with
   -ffp-contract=off. */
DEM_API int dem_build_is_deterministic(void);

/* ---- definition ---- */

DEM_API dem_def dem_default_def(void);
/* Adds a material. Returns its index, or -1 if there are DEM_MATERIALS_MAX already. Units as in dem_material. */
DEM_API int dem_add_material(dem_def *def, double density, double young_modulus, double poisson_ratio);
/* Returns the parameters of a pair of materials, in either order, for editing; NULL if an index is out of range. The
   pair then counts as set, even if it keeps its defaults. */
DEM_API dem_pair_def *dem_pair(dem_def *def, int a, int b);
/* Returns DEM_OK, or DEM_BAD_DEFINITION with the name of the first bad field in *field (field may be NULL). */
DEM_API dem_status dem_check_def(const dem_def *def, const char **field);

/* ---- a world ---- */

/* Makes an empty world with a copy of the definition. *world need not be set before, because its contents are not read.
   Free a world that is in use first, or all its memory is lost. On failure nothing is allocated, and *field (if not
   NULL) names what is wrong. */
DEM_API dem_status dem_init(dem_world *world, const dem_def *def, const char **field);
DEM_API void dem_free(dem_world *world); /* frees everything; safe on a zeroed or freed world */

/* Adds n spheres at rest. centres: shape [n][3] [m]; diameters: [n] [m] > 0; material: index; group: any number of your
   choice, kept in records. Overlaps are allowed and push. On failure nothing is added. Ids, world->id[i], count up in
   array order. */
DEM_API dem_status dem_add_spheres(dem_world *world, ptrdiff_t n, const double *centres, const double *diameters,
                                   int material, int group);
/* Makes a shape of n spheres, overlapping or not. centres: shape [n][3] [m], in any frame; diameters: [n] [m] > 0.
   Volume, centre of mass and moments are those of the union with uniform density, to 1e-8 of the whole in the worst
   case and mostly to rounding. Moments that differ by less than 1e-9 are taken to be equal. A sphere inside another one
   is left out, because it can touch nothing. DEM_TOO_MANY beyond DEM_CLUMP_MAX. */
DEM_API dem_status dem_make_clump(int n, const double *centres, const double *diameters, dem_clump *clump);
/* How well the spheres of a clump fill the body that they stand for (dem_make_clump_from_mesh). */
typedef struct dem_clump_fit {
    double volume;  /* of the union of the spheres over that of the body, less 1 [-] */
    double moments; /* greatest difference between elements of the two tensors of inertia, each about its own centre of
                       mass and of the same density, over the greatest moment [-] */
    double centre;  /* distance of the two centres of mass over the diameter of the sphere of the body's volume [-] */
} dem_clump_fit;

/* Makes a clump from a closed surface, for instance of an STL file: at most n spheres inside it, each of which fills
   most of what those before it leave, to the resolution of a grid of 8000 points in the body. Volume, centre of mass
   and moments are those of the body within the surface, exact. n: 1 .. DEM_CLUMP_MAX; allocator: for working memory,
   NULL: realloc and free; fit: how well the spheres fill the body, may be NULL. Spheres do not protrude, so edges and
   corners of the body are missing. DEM_BAD_ARGUMENT: a surface that is not closed or encloses no volume; DEM_TOO_MANY;
   DEM_OUT_OF_MEMORY. */
DEM_API dem_status dem_make_clump_from_mesh(const dem_mesh *mesh, int n, const dem_allocator *allocator,
                                            dem_clump *clump, dem_clump_fit *fit);
/* Makes a capsule along the x axis: a row of spheres so close that the grooves between them are 1 % of the radius deep.
   diameter, length: overall [m] > 0, length >= diameter. DEM_TOO_MANY from 9.8 diameters on. */
DEM_API dem_status dem_make_capsule(dem_clump *clump, double diameter, double length);
DEM_API double dem_clump_diameter(const dem_clump *clump); /* of the sphere of the same volume [m] */
/* Adds n clumps of one shape at rest. centres: of mass, shape [n][3] [m]. diameters: of spheres of the same volume, [n]
   [m], to which the shape is scaled; NULL: unscaled. orientations: shape [n][4], quaternions (scalar first, of any
   length but 0) from the shape's frame to the world's; NULL: as it was made. Each sphere is a particle. The particles
   of a clump are consecutive, move as one and do not touch each other. A contact sees the mass of the whole clump. On
   failure nothing is added. */
DEM_API dem_status dem_add_clumps(dem_world *world, ptrdiff_t n, const dem_clump *clump, const double *centres,
                                  const double *diameters, const double *orientations, int material, int group);
/* Sets velocity [m/s] and spin [rad/s] of particle i (array index), or of the rigid body of which it is a part, at its
   centre of mass. */
DEM_API dem_status dem_set_motion(dem_world *world, ptrdiff_t i, dem_vec velocity, dem_vec spin);
/* Sets a constant external force [N] at the centre of particle i, and a torque [N m]. They act until changed.
   DEM_BAD_ARGUMENT also for accelerations above 1e80. */
DEM_API dem_status dem_set_load(dem_world *world, ptrdiff_t i, dem_vec force, dem_vec torque);
/* Fixes particle i and the body of which it is a part (1), or releases it (0). A fixed particle stops at once. It then
   stays at rest, or moves with the velocity of dem_set_motion (bodies: without spin), whatever forces act on it. To
   other particles it is an obstacle of its shape; the mass of a contact is theirs, as at a wall. Gravity, loads, walls,
   exits and other fixed particles have no effect on it. It has no energy in the ledger, which books its work on others
   as external_work. */
DEM_API dem_status dem_fix(dem_world *world, ptrdiff_t i, int fixed);
DEM_API int dem_is_fixed(const dem_world *world, ptrdiff_t i); /* 1 or 0 */
/* Returns the forces of contacts and links on a fixed particle, or on the whole fixed body of which it is a part: force
   [N] and torque about the centre [N m] at the end of the last step, and the time integral of the force since it was
   fixed [N s]. For other particles, DEM_BAD_ARGUMENT and NaN. */
DEM_API dem_status dem_get_fixed_force(const dem_world *world, ptrdiff_t i, dem_vec *force, dem_vec *torque,
                                       dem_vec *impulse);
/* Removes particle i, and the body of which it is a part. */
DEM_API dem_status dem_remove(dem_world *world, ptrdiff_t i);

/* ---- filling, feeding, removing ---- */

#define DEM_SIZES_MAX 32 /* sizes of a list at most; a stack of sieves has fewer */

/* A part of space, for filling, removing and measuring. Made by the four functions below. Functions that take a region
   return DEM_BAD_ARGUMENT (or NaN) if it is not finite or a length is negative. */
typedef enum dem_region_kind {
    DEM_REGION_BOX,
    DEM_REGION_CYLINDER,
    DEM_REGION_SPHERE,
    DEM_REGION_MESH
} dem_region_kind;
typedef struct dem_region {
    dem_region_kind kind;
    dem_vec low, high; /* box: its corners; mesh: those of its bounding box; cylinder: centre of its bottom; sphere: its
                          centre [m] */
    dem_vec axis;      /* cylinder: from bottom to top, of any length but 0 */
    double length, radius; /* cylinder, sphere [m] >= 0 */
    const dem_mesh *mesh;  /* the caller's; it must not change while the region is in use */
} dem_region;
DEM_API dem_region dem_box_region(dem_vec low, dem_vec high); /* low = high along an axis: a face */
DEM_API dem_region dem_cylinder_region(dem_vec bottom, dem_vec axis, double length,
                                       double radius); /* length 0: a disc */
DEM_API dem_region dem_sphere_region(dem_vec centre, double radius);
/* Makes a region from the inside of a closed mesh. Where shells overlap, a point is inside if an odd number of them
   encloses it. A mesh that is not closed is refused when the region is used. Filling and measuring sort the triangles
   at each call; dem_region_holds tests all of them. */
DEM_API dem_region dem_mesh_region(const dem_mesh *mesh);
DEM_API double dem_region_volume(const dem_region *region);            /* [m3] */
DEM_API int dem_region_holds(const dem_region *region, dem_vec point); /* 1 if the point is inside or on the surface */

/* Diameters of spheres. Shares are by number or, with by_mass, by mass. Made by the functions below, and open to
   editing. */
typedef enum dem_size_kind {
    DEM_SIZES_LIST,
    DEM_SIZES_UNIFORM,
    DEM_SIZES_LOGNORMAL,
    DEM_SIZES_ROSIN_RAMMLER
} dem_size_kind;
typedef struct dem_sizes {
    dem_size_kind kind;
    int by_mass;                                          /* 1: shares of mass, 0: of number */
    int count;                                            /* list: 1 .. DEM_SIZES_MAX */
    double diameter[DEM_SIZES_MAX], share[DEM_SIZES_MAX]; /* list: [m] > 0; >= 0, of any sum > 0 */
    double scale;             /* lognormal: median; Rosin-Rammler: diameter that 36.8 % exceed [m] > 0 */
    double spread;            /* lognormal: standard deviation of ln d, 1e-3 .. 5; R.-R.: exponent, 0.1 .. 100 */
    double smallest, largest; /* cut-offs, not used by a list [m] > 0, largest <= 1e6 smallest; refused if the share per
                                 ln d is below 1e-20 of its peak everywhere between them */
} dem_sizes;
DEM_API dem_sizes dem_one_size(double diameter);
DEM_API dem_sizes dem_size_list(int n, const double *diameter, const double *share,
                                int by_mass); /* more than DEM_SIZES_MAX: refused later */
DEM_API dem_sizes dem_uniform_sizes(double smallest, double largest, int by_mass);
DEM_API dem_sizes dem_lognormal_sizes(double median, double spread, double smallest, double largest, int by_mass);
/* Makes sizes by Rosin & Rammler 1933: the share coarser than d is exp(-(d/scale)^exponent). */
DEM_API dem_sizes dem_rosin_rammler_sizes(double scale, double exponent, double smallest, double largest, int by_mass);
/* Draws a diameter [m]. *random is the generator's state, at first any number. NaN if the sizes are out of range. Needs
   12 tries on average at most, and never more than 10000. */
DEM_API double dem_draw_size(const dem_sizes *sizes, uint64_t *random);

/* A source of spheres: where, what, and how many so far. It is plain data, owned by the caller: save a copy of it
   beside the world, and a restart continues with the same spheres. (A world may have any number of sources, and most
   have none, so it holds none.) */
typedef struct dem_feed {
    dem_region region; /* spheres lie wholly within it; in a face or a disc, their centres do */
    dem_sizes sizes;
    int material, group;    /* as in dem_add_spheres; default 0 */
    dem_vec velocity;       /* of the new spheres [m/s]; default 0 */
    dem_vec scatter;        /* largest deviation from it, uniform by component [m/s] >= 0; default 0 */
    const dem_clump *clump; /* shape of the bodies, oriented at random; the sizes are then those of spheres of the same
                               volume. It must exist as long as the feed is used. Default NULL: spheres */
    int polyhedron;  /* 1 + number of a shape of the world (dem_add_shape): bodies are polyhedra of that shape and size,
                        oriented at random; sizes are not used, and clump is NULL. Spheres around them keep them apart.
                        Default 0: none */
    const dem_compound *compound; /* bodies of convex parts of that size (dem_make_compound with this world, or with the
                            one whose save it was loaded from), otherwise as polyhedra; clump is NULL and polyhedron 0.
                            It must exist as long as the feed is used. Default NULL: none */
    int tries;       /* random places tried for a sphere before it is dropped, 1 .. 1000000; default 1000 */
    uint64_t random; /* the generator's state; at first the seed; default 1 */
    /* set by the functions below */
    ptrdiff_t placed, missed;        /* spheres placed in all; those for which dem_fill found no place */
    double placed_mass, missed_mass; /* [kg] */
    double due,
        due_mass;   /* what dem_feed_number, dem_feed_mass still owe [-], [kg]; below 0 by half a sphere at most */
    double waiting; /* diameter of the next sphere [m]; 0: not drawn yet */
    uint64_t
        waiting_of; /* identifies the sizes and the shape for which it was drawn; for others it is drawn again. 0:
                       serves for any */
} dem_feed;
DEM_API dem_feed dem_default_feed(void); /* one size of 1 mm in a cube of 0.1 m at the origin, to be edited */

/* Places a number of spheres, or as many as come closest to `mass` [kg], at random, the largest first. They touch
   neither spheres nor enabled walls, and lie outside solid walls (dem_set_solid). Spheres without a place are dropped
   and counted in missed; random places fill up to about 0.3 of a volume within reasonable time. At most feed->tries
   places are tried for each sphere. On failure nothing has changed: DEM_BAD_ARGUMENT, DEM_OUT_OF_MEMORY, DEM_TOO_MANY
   (more than 2e8 spheres; more mass than the density times the volume of the region or, for a mesh, of its bounding
   box), DEM_STOPPED (def.stop; also from the feeds below). */
DEM_API dem_status dem_fill(dem_world *world, dem_feed *feed, ptrdiff_t count);
DEM_API dem_status dem_fill_mass(dem_world *world, dem_feed *feed, double mass);
/* Places what is due within duration [s] >= 0 at a rate [1/s] or [kg/s] >= 0. Call it before every dem_run of that
   duration, which must not exceed the time in which spheres leave the region. A sphere without a place waits, and so do
   those after it, so that sizes keep their shares; `due` tells how far the source is behind. */
DEM_API dem_status dem_feed_number(dem_world *world, dem_feed *feed, double rate, double duration);
DEM_API dem_status dem_feed_mass(dem_world *world, dem_feed *feed, double mass_flow, double duration);
/* One source for several classes: of sizes, groups, materials or shapes. Bodies come one after the other, each from the
   class that is farthest behind its share. If a body has no place, the others wait with it, so the bodies placed have
   the right shares to within one body, however few find room. */
enum { DEM_CLASSES_MAX = 100000 };
typedef struct dem_source {
    dem_feed *feed;      /* [classes] the caller's: sizes, material, group, velocity and shape of each class. Region,
                            tries and generator of the first serve all. Each counts its own placed and missed */
    const double *share; /* [classes] of mass or number, >= 0, not all 0 */
    int classes;         /* 1 .. DEM_CLASSES_MAX */
    int by_number;       /* 0: shares are of mass */
    double due, due_mass; /* what the feeds below still owe [-], [kg]; at first 0. Below 0 by half a body at most */
} dem_source;
/* As dem_fill, dem_fill_mass, dem_feed_number and dem_feed_mass. A body of a fill without a place counts as missed in
   its class. */
DEM_API dem_status dem_fill_source(dem_world *world, dem_source *source, ptrdiff_t count);
DEM_API dem_status dem_fill_source_mass(dem_world *world, dem_source *source, double mass);
DEM_API dem_status dem_feed_source(dem_world *world, dem_source *source, double rate, double duration);
DEM_API dem_status dem_feed_source_mass(dem_world *world, dem_source *source, double mass_flow, double duration);
/* Copies the oldest records of particles that passed exits, at most `capacity`, and removes them from the world.
   Returns how many, or minus a dem_status. records: [capacity], or NULL to drop them. Until then world->passed keeps 88
   bytes for every particle that passed; world->passed_total counts all. dem_residence() reads the records: call it
   first. */
DEM_API ptrdiff_t dem_take_passed(dem_world *world, dem_passed *records, ptrdiff_t capacity);
/* Removes the spheres whose centres lie in the region, and the bodies whose centres of mass do. Returns how many, or
   minus a dem_status. */
DEM_API ptrdiff_t dem_remove_region(dem_world *world, const dem_region *region);

/* Each of these functions adds a wall. It returns the wall's index (>= 0), or minus a dem_status. normal and axis may
   have any length but 0. Walls are independent of each other: on the seam of two flush walls a sphere touches both, and
   both push. A mesh of both has a single surface. */
DEM_API int dem_add_plane(dem_world *world, int material, dem_vec point,
                          dem_vec normal); /* particles are on the side of the normal */
DEM_API int dem_add_cylinder(dem_world *world, int material, dem_vec point, dem_vec axis, double radius, int inside);
DEM_API dem_screen dem_default_screen(void);
DEM_API int dem_add_screen(dem_world *world, int material, const dem_screen *screen);
DEM_API int dem_add_sphere_wall(dem_world *world, int material, dem_vec centre, double radius, int inside);
DEM_API dem_cone dem_default_cone(void);
DEM_API int dem_add_cone(dem_world *world, int material, const dem_cone *cone);
DEM_API dem_disc dem_default_disc(void);
DEM_API int dem_add_disc(dem_world *world, int material, const dem_disc *disc);
/* Adds triangles, which are copied, as one wall: a thin sheet that particles touch from both sides, at faces, edges and
   corners. Its orientation, welding and division into triangles do not matter. Places whose normals differ by less than
   26 degrees are one contact, at the deepest of them (its friction moves with it from triangle to triangle). A sharper
   concave corner makes two contacts. Triangles without area are left out. Besides the common statuses:
   DEM_OUT_OF_MEMORY; DEM_BAD_ARGUMENT if an index or a number is out of range, or no triangle is left. */
DEM_API int dem_add_mesh(dem_world *world, int material, const dem_mesh *mesh);
/* Adds six faces between two corners low < high [m], as a mesh of 12 triangles: a container or a block, in a single
   wall. */
DEM_API int dem_add_box(dem_world *world, int material, dem_vec low, dem_vec high);
/* Makes a mesh or a box a solid body (1), whose inside dem_fill and the feeds leave empty, or a sheet (0, the default),
   such as a container. DEM_BAD_ARGUMENT for a wall that is not a closed mesh: an edge with a single triangle, a
   triangle that exists twice. DEM_OUT_OF_MEMORY. */
DEM_API dem_status dem_set_solid(dem_world *world, int wall, int solid);
/* Sets the groups of particles on which a wall acts, or which an exit removes: bit g for group g = 0 .. 30, bit 31 for
   all others. Default: all. */
DEM_API dem_status dem_set_wall_groups(dem_world *world, int wall, uint32_t groups);
/* Returns 1 if a wall is enabled and acts on particle i's group, otherwise 0. */
DEM_API int dem_wall_acts(const dem_world *world, int wall, ptrdiff_t i);
/* Adds a plane that records and removes particles whose centres pass to the side opposite to the normal. */
DEM_API int dem_add_exit(dem_world *world, dem_vec point, dem_vec normal);

/* These functions move a wall, starting now from where it is. Amplitude [m] and phase [rad] are components along the
   world's axes; frequency [Hz]. Displacement A (sin(2 pi f t + phase) - sin(phase)). */
DEM_API dem_status dem_vibrate(dem_world *world, int wall, dem_vec amplitude, dem_vec phase, double frequency);
DEM_API dem_status dem_move(dem_world *world, int wall, dem_vec velocity);                            /* [m/s] */
DEM_API dem_status dem_rotate(dem_world *world, int wall, dem_vec centre, dem_vec axis, double spin); /* [rad/s] */
/* Moves a wall by a function of time, which replaces its other motions. Velocities are differences over the time step.
   If the wall is prescribed already, only function and centre are replaced. That is so after dem_load: functions are
   not saved, and runs give DEM_NO_MOTION until one is set. DEM_BAD_ARGUMENT if the present pose is not finite. */
DEM_API dem_status dem_prescribe(dem_world *world, int wall, dem_vec centre, dem_motion_fn motion, void *user);
/* Makes a wall a piston, which moves only along axis, as a body of mass [kg] > 0, under the particles' forces, a force
   along the axis [N] (its own weight is not added) and a damper fixed in space [N s/m] >= 0. It begins with its present
   speed along the axis, so that another call can change the force. At rest the particles exert -force on it. The
   damping of contacts takes the wall's mass as infinite, so it should be at least 20 times a particle's. */
DEM_API dem_status dem_control_force(dem_world *world, int wall, dem_vec axis, double mass, double force,
                                     double damping);
/* Makes a wall a rotor, which turns only about a fixed line, with a moment of inertia about it [kg m2] > 0, under the
   particles' torques, a torque [N m] and a damper [N m s/rad] >= 0. Otherwise as dem_control_force. world->wall[].rate
   is its speed [rad/s], coordinate its angle [rad]. */
DEM_API dem_status dem_control_torque(dem_world *world, int wall, dem_vec centre, dem_vec axis, double inertia,
                                      double torque, double damping);
/* Makes a wall a belt: its surface moves at this velocity [m/s], or its component along the surface, while the wall
   stays where it is. */
DEM_API dem_status dem_set_belt(dem_world *world, int wall, dem_vec velocity);
/* Makes a wall a belt around pulleys: where the normal is n, its surface moves along axis x n, at this speed [m/s]
   where the surface is parallel to the axis. Adds to dem_set_belt. */
DEM_API dem_status dem_turn_belt(dem_world *world, int wall, dem_vec axis, double speed);
DEM_API dem_status dem_enable_wall(dem_world *world, int wall, int enabled); /* 0: removes it for particles */
/* Returns the time integral of the torque of particles on a wall about a point at rest [N m s], since the wall was
   added. Its difference between two times, over their interval, is the mean torque. Forces of links are not included.
   NaN for a wall that does not exist. world->wall[].work is the work that the motion of the wall has done on the
   particles [J]. Its difference over the interval is the mean power of the drive, without the inertia of a piston or
   rotor. */
DEM_API dem_vec dem_wall_angular_impulse(const dem_world *world, int wall, dem_vec point);

/* ---- meshes from files ---- */

/* Reads an STL file from memory (3D Systems 1988). The bytes tell whether it is text or binary (docs/dem_walls.md).
   bytes: [size]; scale [m per unit of the file] > 0, 1e-3 for millimetres; weld [m] >= 0: corners closer than this
   become one, 0 joins equal ones only; allocator may be NULL; report may be NULL. DEM_OK also for a file with faults,
   which the report counts; DEM_BAD_DATA if it is not an STL file or no triangle is left; DEM_OUT_OF_MEMORY. On failure
   *mesh is empty. */
DEM_API dem_status dem_read_stl(const void *bytes, size_t size, double scale, double weld,
                                const dem_allocator *allocator, dem_mesh *mesh, dem_stl_report *report);
DEM_API void dem_free_mesh(dem_mesh *mesh); /* frees what dem_read_stl made; safe on a zeroed or freed mesh */

/* ---- running ---- */

/* Advances by duration [s] (to the nearest step; the remainder carries over to the next call). features: DEM_LINEAR |
   DEM_FRICTION | ... Statuses: DEM_BAD_ARGUMENT (features that no shipped law has, more than 9e15 steps),
   DEM_BAD_DEFINITION (def.threads; a sphere wider than 1/2.2 of a periodic box), DEM_LAW_MISMATCH, DEM_NO_MOTION,
   DEM_NO_FIELD, DEM_POLYHEDRON, DEM_BUSY, DEM_OUT_OF_MEMORY, DEM_TOO_MANY, DEM_PAIR_NOT_SET (world->failed_pair), and
   DEM_NOT_FINITE and DEM_TOO_FAST (world->failed_id names the particle, world->step the step at which it was noticed;
   the world can be read, saved and freed). */
DEM_API dem_status dem_run(dem_world *world, double duration, int features);
/* Does the same with a law of your own. kernel: made by DEM_KERNEL; it must outlive the world. Besides the statuses of
   dem_run: DEM_LAW_MISMATCH if the present contacts have the history of a law with another name, version or number of
   states (see dem_law). */
DEM_API dem_status dem_run_law(dem_world *world, double duration, const dem_kernel *kernel);

/* These functions change gravity [m/s2], or the parameters of a pair of materials, between runs. Particles in flight
   and present contacts obey at once. The ledger books the energy of the change as added. DEM_BAD_ARGUMENT: nothing has
   changed. */
DEM_API dem_status dem_set_gravity(dem_world *world, dem_vec gravity);
DEM_API dem_status dem_set_pair(dem_world *world, int a, int b, const dem_pair_def *pair);
/* Changes the time step [s], 1e-60 .. 1e6. */
DEM_API dem_status dem_set_time_step(dem_world *world, double dt);

/* The time steps [s] that the smallest and stiffest present pair needs; infinite where nothing limits them, as before
   the first feed. */
typedef struct dem_advice {
    double contact;  /* duration of the shortest contact, t_c */
    double rayleigh; /* pi R sqrt(rho/G)/(0.1631 nu + 0.8766) of the smallest sphere (materials with moduli) */
    double dashpot;  /* m_eff/gamma of the strongest dashpot */
    double advised;  /* min(t_c/20, 0.2 rayleigh for DEM_HERTZ, dashpot/2); with polyhedra 0.4 of it */
    /* For impacts at the given speed v, of each body with its whole mass m on something rigid: */
    double stiffness; /* linear laws: m v^2/d^2 of the body that needs most [N/m], times dem_convex.springs for a
                         polyhedron. If all pairs have this stiffness, no overlap exceeds d, the rounding of a
                         polyhedron or a tenth of a sphere's radius */
    double depth;     /* overlap over d with the present pairs, of the body that penetrates deepest; above 1 the pairs
                         are too soft */
} dem_advice;
/* Advises on the time step and the stiffness. speed: expected impact speed [m/s] > 0; the time step depends on it only
   with DEM_HERTZ. 0: stiffness and depth are 0. */
DEM_API dem_advice dem_advise(const dem_world *world, int features, double speed);

/* ---- links: forces between bodies that need not touch, smooth enough for a larger step; a liquid bridge ---- */

/* Sets the law of links. Call it before the first link, and again after dem_load. kernel: made by DEM_LINK_KERNEL. Of a
   dem_law, a link uses states, history, vectors, force (gap of either sign; no contact, constants and mass) and ended.
   interval: time between evaluations [s] > 0, rounded down to steps, at least one; the force is constant in between.
   near: gap below which linked bodies also have a contact, by the law of contacts [m] >= 0, at most 0.01 * skin *
   smallest diameter; put forces there that grow fast near contact (lubrication). DEM_LAW_MISMATCH if there are links of
   a law with another name, version or number of states (see dem_law). */
DEM_API dem_status dem_set_links(dem_world *world, const dem_link_kernel *kernel, double interval, double near);
/* Links particle i with j (a particle, or -1 - wall, at one of its elements). state: [law->states]. Call it from a
   law's born hook, or between runs. When a particle leaves, ended is called for its links, and they are removed. From
   the hook ended: DEM_BUSY. */
DEM_API dem_status dem_add_link(dem_world *world, ptrdiff_t i, ptrdiff_t j, int32_t element, const double *state);
DEM_API ptrdiff_t dem_link_count(const dem_world *world);

/* ---- force fields: a force on every particle, in flight and touching; drag in a gas (docs/dem_gas.md) ---- */

DEM_API dem_force_field dem_default_force_field(dem_field_fn kernel, const void *user);
/* Sets the force field, or with NULL removes it. A particle in flight advances by its own steps, chosen by their error
   (Cash & Karp 1990). Between the ends of such a step it is on a parabola that has the right positions at both ends and
   an error of at most `accuracy`; velocities read in between have as small an error. A particle in contact gets the
   force of the law in each step. Where the law gives exactly 0, a flight is the same to the bit as without a field.
   Call this again after dem_load (until then runs give DEM_NO_FIELD), and when the data of the law have changed. The
   time step must be below the shortest relaxation time. A rigid body feels the field at its centre, with the radius of
   the sphere of its volume; dem_sphericities() tells the law its shape. DEM_BAD_ARGUMENT, also for a world with links;
   DEM_OUT_OF_MEMORY. */
DEM_API dem_status dem_set_force_field(dem_world *world, const dem_force_field *field);

/* Computes the constants C1, C2, C3 of the drag coefficient of Hoelzer & Sommerfeld (2008) for dem_gas.shape, for a
   body of volume pi x^3/6 and surface S. sphericity: pi x^2/S, 0 < .. <= 1; crosswise: (pi x^2/4)/A, where A is its
   area seen along the flow; lengthwise: (pi x^2/4)/(S/2 - B), where B is its mean area seen across the flow; both 0 <
   .. <= 100. For a convex body that turns at random all three are equal. NaN outside these ranges. */
DEM_API void dem_shape_of_drag(double sphericity, double crosswise, double lengthwise, double shape[3]);
/* Computes sphericity, crosswise and lengthwise sphericity of the body of particle i, as dem_shape_of_drag takes them,
   in a flow along `flow` (any length but 0). A polyhedron is taken without its rounding; exact, but for `deviation`.
   For clumps: the union of the spheres, with its own volume; the lengthwise one to 1e-3. psi: 1, 1, 1 for a sphere.
   DEM_BAD_ARGUMENT: i is out of range, or `flow` is 0 or not finite. */
DEM_API dem_status dem_body_sphericities(const dem_world *world, ptrdiff_t i, dem_vec flow, double psi[3]);
DEM_API dem_gas dem_default_gas(void); /* air at 20 degrees C, at rest everywhere */
/* Returns DEM_OK, or DEM_BAD_DEFINITION with the name of the first bad field in *field (field may be NULL). */
DEM_API dem_status dem_check_gas(const dem_gas *gas, const char **field);
/* Returns a force field from a kernel made by DEM_GAS, with the gas as its user and half a cell of the grid as its
   length. */
DEM_API dem_force_field dem_gas_field(dem_field_fn kernel, const dem_gas *gas);
/* Attaches the frame to a wall at rest, or moved by dem_rotate or dem_move; it then moves with the wall.
   DEM_BAD_ARGUMENT for other walls. */
DEM_API dem_status dem_attach_gas(dem_gas *gas, const dem_world *world, int wall);
/* Returns the velocity of the gas in the world [m/s] at a position [m] and a time [s]; NaN beyond the grid. */
DEM_API dem_vec dem_gas_velocity(const dem_gas *gas, dem_vec position, double time);
/* Computes the porosity at the grid's nodes from the present volumes of the spheres, each shared among the nodes around
   it; at least 0.2. Cells should be at least 3 diameters wide. porosity: [n[2]][n[1]][n[0]], may be gas->porosity.
   DEM_BAD_ARGUMENT without a finite grid. */
DEM_API dem_status dem_gas_porosity(const dem_world *world, const dem_gas *gas, double *porosity);

/* ---- reading ---- */

DEM_API dem_vec dem_position(const dem_world *world, ptrdiff_t i); /* present position [m]; NaN if i is out of range */
DEM_API dem_vec dem_velocity(const dem_world *world, ptrdiff_t i); /* now [m/s] */
DEM_API dem_vec dem_spin(const dem_world *world, ptrdiff_t i);     /* present spin [rad/s], along the world's axes */
/* Returns the present orientation: from the frame in which the shape was given to the world's. A single sphere has
   none: 1, 0, 0, 0. */
DEM_API dem_quaternion dem_orientation(const dem_world *world, ptrdiff_t i);
/* Returns the present state of the body that particle i is, or is a part of; first is -1 if i is out of range. */
DEM_API dem_body dem_get_body(const dem_world *world, ptrdiff_t i);
/* Turns the body of particle i about its centre of mass to an orientation, a quaternion of any length but 0. Velocity
   and spin stay. DEM_BAD_ARGUMENT for a single sphere, which has no orientation. */
DEM_API dem_status dem_set_orientation(dem_world *world, ptrdiff_t i, dem_quaternion orientation);
DEM_API double dem_radius(const dem_world *world, ptrdiff_t i); /* [m]; NaN if i is out of range */
DEM_API double dem_mass(const dem_world *world, ptrdiff_t i);   /* [kg]; for a part of a body, the body's mass */
DEM_API dem_vec dem_momentum(const dem_world *world);           /* of all particles [kg m/s] */
/* Returns the present energies. Only runs with DEM_ENERGY add to the sums of work and losses. */
DEM_API dem_energy_ledger dem_energy(const dem_world *world);

typedef struct dem_contact_info {
    ptrdiff_t i, j; /* particles; j < 0: wall -1 - j */
    double gap;     /* [m] */
    dem_vec force;  /* on i [N] */
    dem_vec normal,
        point;   /* from j to i; place of the contact, which divides the distance of the centres as the radii do;
                    polyhedra: of the corner, edge or face that touches, so that force acts on i at `point` [m] */
    int element; /* screen: the bar; mesh: 0, 1 ... distinguish a particle's contacts with it */
    double state[DEM_STATE_MAX]; /* of the law */
    dem_vec couple; /* polyhedra: torque on i in addition to that of `force` at `point`, the opposite on j: rolling
                       resistance, and what points that share a law exchange [N m]; otherwise 0 */
} dem_contact_info;
/* Returns link k = 0 .. dem_link_count-1; gap and force as of the last evaluation. */
DEM_API dem_contact_info dem_get_link(const dem_world *world, ptrdiff_t k);
/* Returns the link of particle i with j (a wall: -1 - index) at one of its elements, or -1. */
DEM_API ptrdiff_t dem_find_link(const dem_world *world, ptrdiff_t i, ptrdiff_t j, int32_t element);
DEM_API ptrdiff_t dem_contact_count(const dem_world *world);
/* Returns contact k = 0 .. dem_contact_count-1. Hooks of laws get k as a number; for them force is not set. */
DEM_API dem_contact_info dem_get_contact(const dem_world *world, ptrdiff_t k);
/* Sets the law's states of contact k. state: [law->states]. For hooks of laws, and between runs. */
DEM_API void dem_set_contact_state(dem_world *world, ptrdiff_t k, const double *state);

/* Counts the apertures of a screen at present: whole apertures, those without a blocking particle, those in which any
   particle sits. A particle sits in an aperture if it touches two or more of its bars with its centre within one radius
   of the mesh plane. It blocks if friction would also hold it against reversed gravity. */
typedef struct dem_apertures {
    int total, free, occupied;
} dem_apertures;
DEM_API dem_apertures dem_count_apertures(const dem_world *world, int wall);

/* ---- pure laws, NaN outside their domain ---- */

/* Returns the damping ratio zeta = gamma/(2 sqrt(k m_eff)) that gives the coefficient of restitution e, 0 < e <= 1. */
DEM_API double dem_damping_ratio(double e, dem_restitution mode);
/* Returns the coefficient of restitution of a damping ratio >= 0 (naive: < 1). */
DEM_API double dem_restitution_of(double zeta, dem_restitution mode);
/* Returns the duration of a contact [s]: stiffness k [N/m] > 0, effective mass [kg] > 0. */
DEM_API double dem_contact_time(double k, double mass, double zeta, dem_restitution mode);
/* Returns the duration of an elastic Hertz contact [s] (Hertz 1881): E* [Pa], R* [m], m_eff [kg], impact speed [m/s],
   all > 0. */
DEM_API double dem_hertz_contact_time(double modulus, double radius, double mass, double speed);
