/* ------------------------------------------------------------------------------------------ >>declarations */
/* The public functions, declared and explained.
   Relies on types.h.
   May be changed here alone: comments; a declaration goes with its definition, python/shapes.txt and docs/changes_of_dem.md. */

DEM_INLINE dem_vec dem_vec3(double x, double y, double z) {
    dem_vec v;
    v.x = x, v.y = y, v.z = z;
    return v;
}

/* Component 0, 1 or 2. By name, as what is read beyond the address of x a compiler may take to be nothing of the vector's. */
DEM_INLINE double dem_axis(dem_vec v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
DEM_INLINE double *dem_axis_of(dem_vec *v, int axis) { return axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z; }

DEM_API const char *dem_status_text(dem_status status); /* never NULL */

/* 1 if this header, as built, computes the same bits as others: doubles evaluated as doubles, no fused multiply-add. Found out at run
   time. What the code around it computes is another matter: compile that with -ffp-contract=off. */
DEM_API int dem_build_is_deterministic(void);

/* ---- definition ---- */

DEM_API dem_def dem_default_def(void);
/* Adds a material; returns its index, or -1 if there are DEM_MATERIALS_MAX already. Units as in dem_material. */
DEM_API int dem_add_material(dem_def *def, double density, double young_modulus, double poisson_ratio);
/* The parameters of a pair of materials, in either order, to be edited; the pair counts as set from then on, if only to its defaults. NULL if
   an index is out of range. */
DEM_API dem_pair_def *dem_pair(dem_def *def, int a, int b);
/* DEM_OK, or DEM_BAD_DEFINITION with *field naming the first bad field (field may be NULL). */
DEM_API dem_status dem_check_def(const dem_def *def, const char **field);

/* ---- a world ---- */

/* Makes an empty world with a copy of the definition. On failure nothing is allocated and *field (if not NULL) names what is wrong. */
DEM_API dem_status dem_init(dem_world *world, const dem_def *def, const char **field);
DEM_API void dem_free(dem_world *world); /* frees all; safe on a zeroed or freed world */

/* Adds n spheres at rest. centres: shape [n][3] [m]; diameters: [n] [m] > 0; material: index; group: any number of yours, for records.
   Overlaps are allowed and push. Nothing is added on failure. Ids, world->id[i], count up in array order. */
DEM_API dem_status dem_add_spheres(dem_world *world, ptrdiff_t n, const double *centres, const double *diameters, int material, int group);
/* A shape of n spheres that overlap or not. centres: shape [n][3] [m], in a frame of the shape's own, anywhere; diameters: [n] [m] > 0.
   Volume, centre of mass and moments are those of the union at one density: exact for spheres that do not overlap and for centres on one
   line; else what overlaps is found to about 1e-5 of the whole. Moments that differ by less than that are taken to be equal. A sphere
   that lies within another is left out: it can touch nothing. DEM_TOO_MANY beyond DEM_CLUMP_MAX. */
DEM_API dem_status dem_make_clump(int n, const double *centres, const double *diameters, dem_clump *clump);
DEM_API double dem_clump_diameter(const dem_clump *clump); /* of the sphere of the same volume [m] */
/* Adds n clumps of one shape at rest. centres: of mass, shape [n][3] [m]; diameters: of spheres of the same volume, [n] [m], the shape
   being stretched to that, NULL: as it was made; orientations: shape [n][4], quaternions (scalar first, of any length but 0) from the
   shape's frame to the world's, NULL: as it was made. Each sphere is a particle; those of a clump follow each other, move as one and do
   not touch each other. What touches counts with the mass of the whole. Nothing is added on failure. */
DEM_API dem_status dem_add_clumps(dem_world *world, ptrdiff_t n, const dem_clump *clump, const double *centres, const double *diameters,
                                  const double *orientations, int material, int group);
/* Sets velocity [m/s] and spin [rad/s] of particle i (array index); of the rigid body that it is a part of: of its centre of mass. */
DEM_API dem_status dem_set_motion(dem_world *world, ptrdiff_t i, dem_vec velocity, dem_vec spin);
/* Sets a constant external force [N] at the centre of particle i, and torque [N m], until changed. DEM_BAD_ARGUMENT also where they would
   make accelerations above 1e80. */
DEM_API dem_status dem_set_load(dem_world *world, ptrdiff_t i, dem_vec force, dem_vec torque);
/* Takes particle i out, and with it the body that it is a part of. */
DEM_API dem_status dem_remove(dem_world *world, ptrdiff_t i);

/* ---- filling, feeding, removing ---- */

#define DEM_SIZES_MAX 32 /* sizes of a list: a sieve stack has fewer */

/* A part of space, for filling, removing and measuring. Made by the four functions below; functions that take one return
   DEM_BAD_ARGUMENT (or NaN) if it is not finite or a length is negative. */
typedef enum dem_region_kind { DEM_REGION_BOX, DEM_REGION_CYLINDER, DEM_REGION_SPHERE, DEM_REGION_MESH } dem_region_kind;
typedef struct dem_region {
    dem_region_kind kind;
    dem_vec low, high;     /* box: its corners; of a mesh: of the box around it; cylinder: centre of its bottom; sphere: its centre [m] */
    dem_vec axis;          /* cylinder: from bottom to top, of any length but 0 */
    double length, radius; /* cylinder, sphere [m] >= 0 */
    const dem_mesh *mesh;  /* yours: it must stay as it is while the region is in use */
} dem_region;
DEM_API dem_region dem_box_region(dem_vec low, dem_vec high);                                       /* low = high along an axis: a face */
DEM_API dem_region dem_cylinder_region(dem_vec bottom, dem_vec axis, double length, double radius); /* length 0: a disc */
DEM_API dem_region dem_sphere_region(dem_vec centre, double radius);
/* The inside of a closed mesh; where shells overlap, what an odd number of them encloses. A mesh that is not closed is refused later. To
   fill or measure sorts the triangles at each call; dem_region_holds looks at all of them. */
DEM_API dem_region dem_mesh_region(const dem_mesh *mesh);
DEM_API double dem_region_volume(const dem_region *region);            /* [m3] */
DEM_API int dem_region_holds(const dem_region *region, dem_vec point); /* 1 inside or on the surface */

/* Diameters of spheres. Shares are of the number or, with by_mass, of the mass. Made by the functions below, to be edited. */
typedef enum dem_size_kind { DEM_SIZES_LIST, DEM_SIZES_UNIFORM, DEM_SIZES_LOGNORMAL, DEM_SIZES_ROSIN_RAMMLER } dem_size_kind;
typedef struct dem_sizes {
    dem_size_kind kind;
    int by_mass;                                          /* 1: shares of mass, 0: of number */
    int count;                                            /* list: 1 .. DEM_SIZES_MAX */
    double diameter[DEM_SIZES_MAX], share[DEM_SIZES_MAX]; /* list: [m] > 0; >= 0, of any sum > 0 */
    double scale;                                         /* lognormal: median; Rosin-Rammler: diameter that 36.8 % exceed [m] > 0 */
    double spread;            /* lognormal: standard deviation of ln d, 1e-3 .. 5; R.-R.: exponent, 0.1 .. 100 */
    double smallest, largest; /* where all but the list are cut off [m] > 0, largest <= 1e6 smallest; refused if the share per ln d
                                 nowhere between reaches 1e-20 of its peak */
} dem_sizes;
DEM_API dem_sizes dem_one_size(double diameter);
DEM_API dem_sizes dem_size_list(int n, const double *diameter, const double *share,
                                int by_mass); /* more than DEM_SIZES_MAX: refused later */
DEM_API dem_sizes dem_uniform_sizes(double smallest, double largest, int by_mass);
DEM_API dem_sizes dem_lognormal_sizes(double median, double spread, double smallest, double largest, int by_mass);
/* Rosin & Rammler 1933: share coarser than d is exp(-(d/scale)^exponent). */
DEM_API dem_sizes dem_rosin_rammler_sizes(double scale, double exponent, double smallest, double largest, int by_mass);
/* One diameter [m]; *random is the generator's state, any number to begin with. NaN if the sizes are out of range. Takes 12 tries
   on average at most, and never more than 10000. */
DEM_API double dem_draw_size(const dem_sizes *sizes, uint64_t *random);

/* A source of spheres: where, what, and how far it is. Owned by the caller, plain data: a copy of it beside the saved world makes a
   restart go on with the same spheres. (It is no part of the world because a world may have any number, and most have none.) */
typedef struct dem_feed {
    dem_region region; /* spheres lie wholly within; in a face or disc their centres do */
    dem_sizes sizes;
    int material, group;    /* as in dem_add_spheres; default 0 */
    dem_vec velocity;       /* of the new spheres [m/s]; default 0 */
    dem_vec scatter;        /* largest deviation from it, uniform by component [m/s] >= 0; default 0 */
    const dem_clump *clump; /* shape of what is fed, oriented at random, the sizes being those of spheres of the same volume; it must stay
                               as long as the feed is used. Default NULL: spheres */
    int tries;              /* random places tried for a sphere before it is given up, 1 .. 1000000; default 1000 */
    uint64_t random;        /* the generator's state: the seed at first; default 1 */
    /* written by the functions below */
    ptrdiff_t placed, missed;        /* spheres in all; those that dem_fill found no place for */
    double placed_mass, missed_mass; /* [kg] */
    double due, due_mass;            /* what dem_feed_number, dem_feed_mass still owe [-], [kg]; down to half a sphere ahead */
    double waiting;                  /* diameter of the sphere that is next, 0: none drawn yet [m] */
} dem_feed;
DEM_API dem_feed dem_default_feed(void); /* one size of 1 mm in a cube of 0.1 m at the origin: to be edited */

/* Places so many spheres, or the number whose mass comes nearest to `mass` [kg], at random places where they touch neither spheres nor
   enabled walls and are in no solid one (dem_set_solid), the largest first. Spheres that find no place are dropped and counted in missed;
   random places fill up to about 0.3 of a volume within reasonable time. Statuses: DEM_BAD_ARGUMENT, DEM_OUT_OF_MEMORY, DEM_TOO_MANY; then
   nothing has changed. */
DEM_API dem_status dem_fill(dem_world *world, dem_feed *feed, ptrdiff_t count);
DEM_API dem_status dem_fill_mass(dem_world *world, dem_feed *feed, double mass);
/* Places what falls due within duration [s] >= 0 at a rate [1/s] or [kg/s] >= 0; call it before every dem_run of that duration, no longer
   than spheres need to clear the region. One that finds no place waits, and with it those behind it, so that sizes keep their shares: due
   tells how far the source is behind. */
DEM_API dem_status dem_feed_number(dem_world *world, dem_feed *feed, double rate, double duration);
DEM_API dem_status dem_feed_mass(dem_world *world, dem_feed *feed, double mass_flow, double duration);
/* Hands over the records of what passed exits, the oldest first, at most `capacity`, and takes them out of the world; returns how many, or
   minus a dem_status. records: [capacity], or NULL to drop them. Without it world->passed keeps 88 bytes of every particle that ever
   passed; world->passed_total counts them whatever is taken. dem_residence() reads the records: call it first. */
DEM_API ptrdiff_t dem_take_passed(dem_world *world, dem_passed *records, ptrdiff_t capacity);
/* Takes out the spheres whose centres lie in the region; returns how many, or minus a dem_status. */
DEM_API ptrdiff_t dem_remove_region(dem_world *world, const dem_region *region);

/* Walls. Each returns the wall's index (>= 0), or minus a dem_status. normal and axis need not have length 1, but not 0. Walls do not know
   each other: on the seam of two that lie flush a sphere touches both, and both push. One mesh of both has one surface. */
DEM_API int dem_add_plane(dem_world *world, int material, dem_vec point, dem_vec normal); /* particles on the side of the normal */
DEM_API int dem_add_cylinder(dem_world *world, int material, dem_vec point, dem_vec axis, double radius, int inside);
DEM_API dem_screen dem_default_screen(void);
DEM_API int dem_add_screen(dem_world *world, int material, const dem_screen *screen);
DEM_API int dem_add_sphere_wall(dem_world *world, int material, dem_vec centre, double radius, int inside);
DEM_API dem_cone dem_default_cone(void);
DEM_API int dem_add_cone(dem_world *world, int material, const dem_cone *cone);
/* Triangles, copied, as one wall: a thin sheet that particles touch from both sides, at faces, edges and corners; how it is oriented,
   welded or cut into triangles does not matter. Places whose normals differ by less than 26 degrees are one contact (its friction goes
   with it from triangle to triangle), the deepest; a sharper concave corner makes two. Triangles without area are left out. Besides the
   common statuses: DEM_OUT_OF_MEMORY; DEM_BAD_ARGUMENT if an index or a number is out of range, or no triangle is left. */
DEM_API int dem_add_mesh(dem_world *world, int material, const dem_mesh *mesh);
/* Six faces between two corners low < high [m], as a mesh of 12 triangles: a container or a block, one wall to be moved as one. */
DEM_API int dem_add_box(dem_world *world, int material, dem_vec low, dem_vec high);
/* 1: a mesh or box is a solid body, whose inside dem_fill and the feeds leave empty; 0, as at first: a sheet, a container. DEM_BAD_ARGUMENT
   for a wall that is not a closed mesh: an edge of one triangle only, a triangle that is there twice. DEM_OUT_OF_MEMORY. */
DEM_API dem_status dem_set_solid(dem_world *world, int wall, int solid);
/* The groups of particles that a wall acts on, or an exit removes: bit g for group g = 0 .. 30, bit 31 for all others; at first all. */
DEM_API dem_status dem_set_wall_groups(dem_world *world, int wall, uint32_t groups);
/* 1 if a wall is enabled and acts on particle i's group, else 0. */
DEM_API int dem_wall_acts(const dem_world *world, int wall, ptrdiff_t i);
/* A plane that records and removes particles whose centre passes to the side opposite to the normal. */
DEM_API int dem_add_exit(dem_world *world, dem_vec point, dem_vec normal);

/* Motions begin now, from where the wall is. Amplitude [m] and phase [rad] by component of the world's axes; frequency [Hz].
   Displacement A (sin(2 pi f t + phase) - sin(phase)). */
DEM_API dem_status dem_vibrate(dem_world *world, int wall, dem_vec amplitude, dem_vec phase, double frequency);
DEM_API dem_status dem_move(dem_world *world, int wall, dem_vec velocity);                            /* [m/s] */
DEM_API dem_status dem_rotate(dem_world *world, int wall, dem_vec centre, dem_vec axis, double spin); /* [rad/s] */
/* The wall goes where a function of time says; that replaces its other motions. Velocities follow from differences over the time step.
   Called again for a wall that is prescribed already, as after dem_load (functions are not saved: until then running gives
   DEM_NO_MOTION), it replaces function and centre only. DEM_BAD_ARGUMENT if the pose now is not finite. */
DEM_API dem_status dem_prescribe(dem_world *world, int wall, dem_vec centre, dem_motion_fn motion, void *user);
/* A piston: the wall moves along axis only, as a body of mass [kg] > 0 under the particles' forces, a force along the axis [N] (its own
   weight is not added) and a damper fixed in space [N s/m] >= 0. It begins with the speed along the axis that it has, so that it can be
   called again to change the force. At rest the particles exert -force on it. A contact's damping takes the wall's mass for
   infinite: it should be 20 times a particle's or more. */
DEM_API dem_status dem_control_force(dem_world *world, int wall, dem_vec axis, double mass, double force, double damping);
/* A rotor: the wall turns about a fixed line only, with a moment of inertia about it [kg m2] > 0, under the particles' torques, a torque
   [N m] and a damper [N m s/rad] >= 0. Else as dem_control_force. world->wall[].rate is its speed [rad/s], coordinate its angle [rad]. */
DEM_API dem_status dem_control_torque(dem_world *world, int wall, dem_vec centre, dem_vec axis, double inertia, double torque,
                                      double damping);
/* A belt: the surface runs with this velocity [m/s], or with its part along the surface, while the wall stays where it is. */
DEM_API dem_status dem_set_belt(dem_world *world, int wall, dem_vec velocity);
DEM_API dem_status dem_enable_wall(dem_world *world, int wall, int enabled); /* 0: as if it were not there */

/* ---- meshes from files ---- */

/* Reads an STL file from memory (3D Systems 1988), text or binary by what the bytes are (docs/dem_walls.md). bytes: [size]; scale [m per
   unit of the file] > 0, 1e-3 for millimetres; weld [m] >= 0: corners nearer than this become one, 0 joins equal ones only; allocator may
   be NULL; report may be NULL. DEM_OK also for a file with faults, which the report counts; DEM_BAD_DATA if it is no STL file or no
   triangle is left; DEM_OUT_OF_MEMORY. On failure *mesh is empty. */
DEM_API dem_status dem_read_stl(const void *bytes, size_t size, double scale, double weld, const dem_allocator *allocator, dem_mesh *mesh,
                                dem_stl_report *report);
DEM_API void dem_free_mesh(dem_mesh *mesh); /* frees what dem_read_stl made; safe on a zeroed or freed one */

/* ---- running ---- */

/* Advances by duration [s] (to the nearest step; remainders carry over to the next call). features: DEM_LINEAR | DEM_FRICTION | ...
   Statuses: DEM_BAD_ARGUMENT (features that no shipped law has, more than 9e15 steps), DEM_BAD_DEFINITION (def.threads; a sphere wider than
   1/2.2 of a periodic box), DEM_LAW_MISMATCH, DEM_NO_MOTION, DEM_OUT_OF_MEMORY, and DEM_NOT_FINITE and DEM_TOO_FAST (world->failed_id names
   the particle, world->step the step at which it was noticed; the world can be read, saved and freed). */
DEM_API dem_status dem_run(dem_world *world, double duration, int features);
/* The same with a law of your own: kernel is what DEM_KERNEL made of it; it must outlive the world. Besides the statuses of dem_run:
   DEM_LAW_MISMATCH if the contacts present keep another number of states than the law. */
DEM_API dem_status dem_run_law(dem_world *world, double duration, const dem_kernel *kernel);

/* Changes gravity [m/s2], or the parameters of a pair of materials, from now on, for what flies and touches already, too. Between runs. The
   ledger books the energy that this makes with what is added. DEM_BAD_ARGUMENT; nothing has changed then. */
DEM_API dem_status dem_set_gravity(dem_world *world, dem_vec gravity);
DEM_API dem_status dem_set_pair(dem_world *world, int a, int b, const dem_pair_def *pair);
/* Changes the time step [s] > 0 from now on. */
DEM_API dem_status dem_set_time_step(dem_world *world, double dt);

/* The time steps [s] that the smallest and stiffest pair present asks for; infinite where nothing limits, as before the first feed. */
typedef struct dem_advice {
    double contact;  /* duration of the shortest contact, t_c */
    double rayleigh; /* pi R sqrt(rho/G)/(0.1631 nu + 0.8766) of the smallest sphere (materials with moduli) */
    double dashpot;  /* m_eff/gamma of the strongest dashpot */
    double advised;  /* min(t_c/20, 0.2 rayleigh for DEM_HERTZ, dashpot/2) */
} dem_advice;
/* speed: expected impact speed [m/s] > 0; used by DEM_HERTZ only. */
DEM_API dem_advice dem_advise(const dem_world *world, int features, double speed);

/* ---- links: forces between bodies that need not touch, smooth enough for a larger step; a liquid bridge ---- */

/* Sets the law of links; before the first link, and again after dem_load. kernel: what DEM_LINK_KERNEL made of it. Of a dem_law, a link
   uses states, history, vectors, force (gap of any sign; contact, constants and mass are not there) and ended.
   interval: time between evaluations [s] > 0, rounded down to steps, at least one; the force is constant between.
   near: gap below which linked bodies are in contact for the law of contacts too [m] >= 0, at most 0.01 * skin * smallest diameter;
   what grows fast near contact (lubrication) belongs there. DEM_LAW_MISMATCH if there are links with another number of states. */
DEM_API dem_status dem_set_links(dem_world *world, const dem_link_kernel *kernel, double interval, double near);
/* Links particle i with j (particle, or -1 - wall at an element of it). state: [law->states]. From a law's born hook, or between runs.
   Links follow a particle's leaving: ended is called, and the link is gone. */
DEM_API dem_status dem_add_link(dem_world *world, ptrdiff_t i, ptrdiff_t j, int32_t element, const double *state);
DEM_API ptrdiff_t dem_link_count(const dem_world *world);

/* ---- force fields: a force on every particle, in flight and touching; drag in a gas (docs/dem_gas.md) ---- */

DEM_API dem_force_field dem_default_force_field(dem_field_fn kernel, const void *user);
/* Sets the force field from now on, or with NULL takes it off. A particle in flight advances by steps of its own, chosen by the error (Cash
   & Karp 1990); between their ends it is on a parabola that is there in place and within `accuracy`, so that velocities read meanwhile are
   off by as little. A touching one feels the law in each step. Where the law gives exactly 0 a flight is what it is without a field, to
   the bit. Call it again after dem_load (until then running gives DEM_NO_FIELD), and when what the law reads has changed. The time step
   must be below the shortest relaxation time. DEM_BAD_ARGUMENT, also for a world with links or rigid bodies; DEM_OUT_OF_MEMORY. */
DEM_API dem_status dem_set_force_field(dem_world *world, const dem_force_field *field);

/* Constants C1, C2, C3 of the drag coefficient of Hoelzer & Sommerfeld (2008) for dem_gas.shape, of a body of volume pi x^3/6 and
   surface S. sphericity: pi x^2/S, 0 < .. <= 1; crosswise: (pi x^2/4)/A, A its area seen along the flow; lengthwise: (pi x^2/4)/(S/2 - B),
   B its mean area seen across the flow; both 0 < .. <= 100. A convex body that turns at random has all three equal. {NaN} else. */
DEM_API void dem_shape_of_drag(double sphericity, double crosswise, double lengthwise, double shape[3]);
DEM_API dem_gas dem_default_gas(void); /* air at 20 degrees C, at rest everywhere */
/* DEM_OK, or DEM_BAD_DEFINITION with *field naming the first bad field (field may be NULL). */
DEM_API dem_status dem_check_gas(const dem_gas *gas, const char **field);
/* A force field of a kernel made by DEM_GAS, with the gas as its user and half a cell of the grid as its length. */
DEM_API dem_force_field dem_gas_field(dem_field_fn kernel, const dem_gas *gas);
/* Attaches the frame to a wall moved by dem_rotate or dem_move, or at rest: it goes with it from now on. DEM_BAD_ARGUMENT for others. */
DEM_API dem_status dem_attach_gas(dem_gas *gas, const dem_world *world, int wall);
/* Velocity of the gas in the world [m/s] at a place [m] and a time [s]; NaN beyond the grid. */
DEM_API dem_vec dem_gas_velocity(const dem_gas *gas, dem_vec position, double time);
/* Porosity at the grid's nodes from the volumes of the spheres now, each shared among the nodes around it; at least 0.2. Cells should be
   3 diameters wide or more. porosity: [n[2]][n[1]][n[0]], which gas->porosity may be. DEM_BAD_ARGUMENT without a finite grid. */
DEM_API dem_status dem_gas_porosity(const dem_world *world, const dem_gas *gas, double *porosity);

/* ---- reading ---- */

DEM_API dem_vec dem_position(const dem_world *world, ptrdiff_t i); /* now [m]; NaN if i is out of range */
DEM_API dem_vec dem_velocity(const dem_world *world, ptrdiff_t i); /* now [m/s] */
DEM_API dem_vec dem_spin(const dem_world *world, ptrdiff_t i);     /* now [rad/s], along the world's axes */
/* From the frame in which its shape was given to the world's, now. A sphere by itself has none: 1, 0, 0, 0. */
DEM_API dem_quaternion dem_orientation(const dem_world *world, ptrdiff_t i);
/* The body that particle i is, or is a part of, now; first is -1 if i is out of range. */
DEM_API dem_body dem_get_body(const dem_world *world, ptrdiff_t i);
/* Turns the body of particle i about its centre of mass into an orientation, a quaternion of any length but 0. Velocity and spin stay.
   DEM_BAD_ARGUMENT for a sphere by itself, which has none. */
DEM_API dem_status dem_set_orientation(dem_world *world, ptrdiff_t i, dem_quaternion orientation);
DEM_API double dem_radius(const dem_world *world, ptrdiff_t i); /* [m]; NaN if i is out of range */
DEM_API double dem_mass(const dem_world *world, ptrdiff_t i);   /* [kg]; of a part of a body: the body's */
DEM_API dem_vec dem_momentum(const dem_world *world);           /* of all particles [kg m/s] */
/* Energy now. Sums of work and losses are kept by runs with DEM_ENERGY only. */
DEM_API dem_energy_ledger dem_energy(const dem_world *world);

typedef struct dem_contact_info {
    ptrdiff_t i, j;              /* particles; j < 0: wall -1 - j */
    double gap;                  /* [m] */
    dem_vec force;               /* on i [N] */
    dem_vec normal, point;       /* from j to i; where they touch, which divides the distance of the centres as the radii do [m] */
    int element;                 /* of a screen: the bar; of a mesh: 0, 1 ... tell a particle's contacts with it apart */
    double state[DEM_STATE_MAX]; /* of the law */
} dem_contact_info;
/* Link k = 0 .. dem_link_count-1; gap and force as last evaluated. */
DEM_API dem_contact_info dem_get_link(const dem_world *world, ptrdiff_t k);
/* The link of particle i with j (a wall: -1 - index) at an element of it, or -1. */
DEM_API ptrdiff_t dem_find_link(const dem_world *world, ptrdiff_t i, ptrdiff_t j, int32_t element);
DEM_API ptrdiff_t dem_contact_count(const dem_world *world);
/* Contact k = 0 .. dem_contact_count-1 (a slot, to hooks of laws); in those without its force. */
DEM_API dem_contact_info dem_get_contact(const dem_world *world, ptrdiff_t k);
/* Sets the law's states of contact k. state: [law->states]. For hooks of laws, and between runs. */
DEM_API void dem_set_contact_state(dem_world *world, ptrdiff_t k, const double *state);

/* Apertures of a screen now: whole apertures, those without a blocking particle, those with any particle sitting in them.
   A particle sits in an aperture if it touches two or more of its bars with its centre within one radius of the mesh plane; it
   blocks if, besides, friction would hold it were gravity reversed. */
typedef struct dem_apertures {
    int total, free, occupied;
} dem_apertures;
DEM_API dem_apertures dem_count_apertures(const dem_world *world, int wall);

/* ---- measuring: readers of a world, into arrays of the caller; DEM_BAD_ARGUMENT for what is not finite or out of range ---- */

/* Stresses are pressures: positive where spheres push. First index: force, or momentum; second: direction in which it is carried. */
typedef struct dem_measure {
    ptrdiff_t count;             /* spheres whose centres lie in the region */
    double mass;                 /* of them [kg] */
    double solid_fraction;       /* volume of the parts of spheres in the region over its volume [-]; exact for box and sphere, 1e-4 for a
                                    cylinder, 1e-2 of what the surface of a mesh cuts; what overlaps counts twice */
    double coordination;         /* contacts of a sphere, mean of those in it [-] */
    dem_vec velocity;            /* mean by mass [m/s] */
    double granular_temperature; /* sum m |v - velocity|^2/(3 sum m) [m2/s2] */
    double contact_stress[3][3]; /* sum F l/V over contacts and links, l the part of the branch in the region [Pa]; the branch goes from
                                    centre to centre, from a wall's point to the centre (Goldhirsch 2010, the region as kernel) */
    double kinetic_stress[3][3]; /* sum m v' v'/V, v' = v - velocity [Pa] */
} dem_measure;
/* Along periodic axes a region is no longer than the box. A region without volume has NaN where it would be divided by. With a mesh also
   DEM_OUT_OF_MEMORY. */
DEM_API dem_status dem_measure_region(const dem_world *world, const dem_region *region, dem_measure *measure);

/* A block of cells; n of 1 along an axis: no profile along it. */
typedef struct dem_cells {
    dem_vec low, high; /* corners of the block [m] */
    int n[3];          /* cells by axis, 1 .. 100000, their product < 2^30 */
    double width[3];   /* half width of the kernel by axis [m] >= 0; 0: none, a centre counts in its cell */
} dem_cells;
/* Fields in a cell: means over it of the coarse-grained fields. */
typedef struct dem_field {
    double density;              /* [kg/m3] */
    dem_vec momentum;            /* density of it [kg/(m2 s)]; over density: velocity */
    double contact_stress[3][3]; /* [Pa] */
    double kinetic_stress[3][3]; /* with v' from the cell's own velocity [Pa] */
} dem_field;
/* Coarse-grained fields (Goldhirsch 2010, Granular Matter 12, 239, eqs 5, 6, 25, 30) with the kernel product of 15/16 (1 - u^2)^2 by
   axis, u = distance/width. field: [n[2]][n[1]][n[0]]. Masses are integrated exactly over cells: their sum is that of the spheres, if
   the block reaches a width beyond them; branches by Gauss's rule with 8 points. */
DEM_API dem_status dem_coarse_grain(const dem_world *world, const dem_cells *cells, dem_field *field);

/* Histogram of contacts over `bins` equal bins from low to high, low < high: forces [N] or overlaps [m]; without those that only
   nearly touch. count: [bins]. Returns how many lie outside, or minus a dem_status. */
typedef enum dem_quantity { DEM_CONTACT_FORCE, DEM_CONTACT_OVERLAP } dem_quantity;
DEM_API ptrdiff_t dem_histogram(const dem_world *world, dem_quantity quantity, double low, double high, int bins, double *count);

/* Times in a region, to be called at intervals [s], which are its resolution; ids < n are followed. entered: [n] time of entering, NaN
   outside, NaN at first; stayed: [n] sum of the visits that are over, 0 at first. Leaving by an exit counts at its own time. */
DEM_API dem_status dem_residence(const dem_world *world, const dem_region *region, ptrdiff_t n, double *entered, double *stayed);

/* Centres by cell: those of one group, and all. [n[2]][n[1]][n[0]] each; width is not used. */
DEM_API dem_status dem_count_in_cells(const dem_world *world, const dem_cells *cells, int group, double *of_group, double *of_all);
/* How mixed two species are, from their numbers by sample: [samples] of one, of both; empty samples do not count. All NaN if one
   species is missing, or a number is negative or larger than that of both. */
typedef struct dem_mixing {
    double share;       /* of the one species in all [-] */
    double separated;   /* variance of its share over samples, weighted by their numbers: if each sample held one species only, */
    double random;      /* expected of a random mixture, for these sizes of samples, */
    double variance;    /* and as it is [-] */
    double lacey;       /* (separated - variance)/(separated - random): 0 separated, 1 on average in a random mixture (Lacey 1954) */
    double segregation; /* variance/separated: 1 separated (intensity of segregation, Danckwerts 1952) */
} dem_mixing;
DEM_API dem_mixing dem_mixing_of(ptrdiff_t samples, const double *of_group, const double *of_all);
/* Contacts between a group and the others over what chance would make of the contacts: 0 separated, 1 random. NaN without contacts. */
DEM_API double dem_unlike_contacts(const dem_world *world, int group);

/* Volume of a ball within a box, its centre at the origin [m3] (closed form: Gauss-Bonnet for the sphere's part, then the divergence
   theorem). radius > 0, low <= high by axis; NaN else. */
DEM_API double dem_ball_in_box(double radius, dem_vec low, dem_vec high);

/* A number that depends on every bit of the particles' state and histories, and of controlled walls. */
DEM_API uint64_t dem_hash(const dem_world *world);

/* Saves everything that the future depends on, little-endian, with version and checksum. Returns the size in bytes; writes only if
   capacity is enough (call with NULL, 0 first). */
DEM_API size_t dem_save(const dem_world *world, void *buffer, size_t capacity);
/* Makes a world from saved bytes. allocator may be NULL. The run goes on with the same bits. */
DEM_API dem_status dem_load(dem_world *world, const void *buffer, size_t size, const dem_allocator *allocator);

/* ---- pure laws, NaN outside their domain ---- */

/* Damping ratio zeta = gamma/(2 sqrt(k m_eff)) that gives the coefficient of restitution e, 0 < e <= 1. */
DEM_API double dem_damping_ratio(double e, dem_restitution mode);
/* Coefficient of restitution of a damping ratio >= 0 (naive: < 1). */
DEM_API double dem_restitution_of(double zeta, dem_restitution mode);
/* Duration of a contact [s]: stiffness k [N/m] > 0, effective mass [kg] > 0. */
DEM_API double dem_contact_time(double k, double mass, double zeta, dem_restitution mode);
/* Duration of an elastic Hertz contact [s] (Hertz 1881): E* [Pa], R* [m], m_eff [kg], impact speed [m/s], all > 0. */
DEM_API double dem_hertz_contact_time(double modulus, double radius, double mass, double speed);
