/* Public types: what a host can see of a world. */
#pragma once
#include "compiler.h"
#include "constants.h"

#define DEM_STATUSES(X)                                                                                                \
    X(DEM_OK, "ok")                                                                                                    \
    X(DEM_BAD_ARGUMENT, "an argument is outside its range")                                                            \
    X(DEM_BAD_DEFINITION, "a field of the definition is outside its range")                                            \
    X(DEM_OUT_OF_MEMORY, "out of memory")                                                                              \
    X(DEM_NOT_FINITE, "a particle's force or position is not finite")                                                  \
    X(DEM_TOO_FAST,                                                                                                    \
      "a particle moves more than half its radius, a polyhedron more than its width, or a body turns by a hundred "    \
      "radians, in one step")                                                                                          \
    X(DEM_TOO_MANY, "more walls, materials or particles than this header counts, or more mass than a region can hold") \
    X(DEM_BAD_DATA, "neither a whole saved world of this version nor an STL file with triangles")                      \
    X(DEM_LAW_MISMATCH,                                                                                                \
      "the contacts or links present are of a law with another name, version or number of states, or "                 \
      "links have no law: call dem_set_links after dem_load")                                                          \
    X(DEM_NO_MOTION, "a wall's motion is a function, which dem_prescribe must name again after loading")               \
    X(DEM_NO_FIELD, "a force field's law is a function, which dem_set_force_field must name again after loading")      \
    X(DEM_BUSY,                                                                                                        \
      "the world is running: a law's hooks may read it, set states of contacts and (born) add links, nothing else")    \
    X(DEM_POLYHEDRON, "polyhedra take no links, and run with DEM_FRICTION only (a coefficient of 0 takes it out)")     \
    X(DEM_PAIR_NOT_SET, "two different materials touch whose pair was never set: call dem_pair() or dem_set_pair()")   \
    X(DEM_STOPPED, "stopped by the definition's function stop; nothing has changed")
#define DEM__NAME(name, text) name,
typedef enum dem_status { DEM_STATUSES(DEM__NAME) DEM_STATUS_COUNT } dem_status;
#undef DEM__NAME

typedef struct dem_vec {
    double x, y, z;
} dem_vec;

DEM_INLINE dem_vec dem_vec3(double x, double y, double z) {
    dem_vec v;
    v.x = x, v.y = y, v.z = z;
    return v;
}

/* Returns component 0, 1 or 2. Named members, because a compiler may assume that an access beyond the address of x does
   not reach y. */
DEM_INLINE double dem_axis(dem_vec v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
DEM_INLINE double *dem_axis_of(dem_vec *v, int axis) { return axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z; }

/* An orientation: the rotation from a body's own frame to the world's, as a quaternion of length 1. */
typedef struct dem_quaternion {
    double w, x, y, z; /* cosine of half the angle; unit axis times the sine of half the angle */
} dem_quaternion;

/* What a run computes; combined by |. Normal law: exactly one of DEM_LINEAR and DEM_HERTZ. */
enum {
    DEM_LINEAR = 1,   /* linear spring-dashpot */
    DEM_HERTZ = 2,    /* Hertz; with DEM_FRICTION, Mindlin's tangential stiffness */
    DEM_FRICTION = 4, /* tangential spring with Coulomb limit, torques */
    DEM_ROLLING = 8,  /* rolling resistance; needs DEM_FRICTION */
    DEM_ENERGY = 16   /* energy ledger, dem_energy() */
};

/* Layers of skipping, all on by default. They change no bit of a result, only the time that a run takes. */
enum {
    DEM_SKIP_PAIRS = 1, /* pairs are not tested before they can touch */
    DEM_SKIP_SPACE = 2, /* particles are not tested with walls that they cannot reach */
    DEM_SKIP_ALL = 3
};

/* How the dashpot of DEM_LINEAR follows from the coefficient of restitution. */
typedef enum dem_restitution {
    DEM_CLIPPED, /* the dashpot never pulls: a contact ends when the force is zero (Schwager & Poeschel 2007) */
    DEM_NAIVE    /* the dashpot may pull at the end: a contact ends when the overlap is zero */
} dem_restitution;

struct dem_world;
#define DEM_CLUMP_MAX 64 /* spheres of a clump, at most */

/* A shape of spheres fixed to each other, overlapping or not. Made by dem_make_clump(). Volume, moments and axes may be
   replaced by better ones; then make the centres relative to the true centre of mass. */
typedef struct dem_clump {
    int spheres;                   /* 1 .. DEM_CLUMP_MAX; only those that can touch something */
    dem_vec centre[DEM_CLUMP_MAX]; /* from the centre of mass, in the frame in which the shape was given [m] */
    double radius[DEM_CLUMP_MAX];  /* [m] */
    dem_vec origin;                /* the centre of mass, in the frame in which the shape was given [m] */
    double volume;                 /* of the union [m3] */
    dem_vec moments;     /* principal moments of inertia over the density [m5]; the two that differ least first */
    dem_quaternion axes; /* from the principal axes to the frame in which the shape was given */
    /* private: dem_add_clumps. Feeds call through it, so that a program without clumps does not compile rigid bodies */
    dem_status (*add__)(struct dem_world *world, ptrdiff_t n, const struct dem_clump *clump, const double *centres,
                        const double *diameters, const double *orientations, int material, int group);
} dem_clump;

#define DEM_PARTS_MAX 64 /* convex parts of a compound at most */
/* A body of convex parts fixed to each other, concave as a whole. Made by dem_make_compound(). Volume, moments and axes
   may be replaced by better ones; then make the centres relative to the true centre of mass. */
typedef struct dem_compound {
    int parts;                          /* 1 .. DEM_PARTS_MAX */
    int shape[DEM_PARTS_MAX];           /* the world's shape of each part */
    dem_vec centre[DEM_PARTS_MAX];      /* centroids, from the centre of mass, in the frame of the compound [m] */
    dem_quaternion turn[DEM_PARTS_MAX]; /* from the frame in which a part was given to that of the compound */
    dem_vec origin;                     /* the centre of mass, in the frame of the compound [m] */
    double volume;                      /* sum over the parts [m3] */
    dem_vec moments;     /* principal moments of inertia over the density [m5]; the two that differ least first */
    dem_quaternion axes; /* from the principal axes to the frame of the compound */
    /* private: dem_add_compounds. Feeds call through it, so that a program without compounds does not compile them */
    dem_status (*add__)(struct dem_world *world, ptrdiff_t n, const struct dem_compound *compound,
                        const double *centres, const double *orientations, int material, int group);
} dem_compound;

typedef struct dem_material {
    double density;       /* [kg/m3] > 0 */
    double young_modulus; /* [Pa] > 0; used by DEM_HERTZ and the Rayleigh time */
    double poisson_ratio; /* [-] 0 .. 0.5 */
} dem_material;

/* Parameters of contacts between two materials. No defaults would suit two different materials: if they touch and their
   pair was never set, the run gives DEM_PAIR_NOT_SET. */
typedef struct dem_pair_def {
    double stiffness;        /* k_n [N/m] > 0; DEM_LINEAR only; default 1e5 */
    double tangential_ratio; /* k_t / k_n [-] 0 .. 1; DEM_LINEAR only; default 2/7 */
    double restitution;      /* coefficient of restitution e [-] 0 < e <= 1; default 0.8 */
    double friction;         /* Coulomb coefficient [-] >= 0; default 0.3 */
    double rolling; /* lever arm of rolling resistance [m] >= 0; default 0. On a slope below its limit a ball creeps at
                       5 g sin(slope) dt; the law contact_epsd in dem_laws.h holds it by a spring */
    double tangential_damping; /* tangential dashpot over the normal one [-] >= 0; default 0 */
    dem_restitution mode;      /* DEM_LINEAR only; default DEM_CLIPPED */
    int given;                 /* 1: the pair counts as set; dem_pair() and dem_set_pair() set it; default 0 */
} dem_pair_def;

/* Memory hook: fn(user, old, old_size, new_size). new_size 0 frees; old NULL allocates. Returns NULL when out of
   memory. */
typedef struct dem_allocator {
    void *(*fn)(void *user, void *old, size_t old_size, size_t new_size);
    void *user;
} dem_allocator;

/* Everything that does not change in time. Made by dem_default_def(). */
typedef struct dem_def {
    uint32_t cookie; /* set by dem_default_def(); a definition without it is refused */
    int materials;   /* number of materials, by dem_add_material() */
    int threads;     /* number of threads >= 1; default 1; world->def.threads may be changed between runs */
    int skip;        /* DEM_SKIP_*; default DEM_SKIP_ALL */
    double dt;       /* time step [s] 1e-60 .. 1e6; default 1e-6; dem_advise() gives a good one */
    double skin;     /* skin of the neighbour list, over the smallest diameter [-] > 0; default 0.35. If lists last less
                        than 100 steps (400 where pairs are few), the engine takes up to three times as much; in a
                        narrow periodic box, less */
    dem_vec gravity; /* [m/s2]; default (0, 0, -9.81) */
    int periodic[3]; /* 1: the axis is periodic from low to high, a length of more than 2.2 times the largest diameter;
                        default 0. Walls are not repeated: extend them a diameter past the box */
    dem_vec low, high;       /* [m]; used on periodic axes only; default 0 and 1 */
    dem_allocator allocator; /* default: realloc and free */
    /* Runs task(context, index) for every index below tasks, in any order and on any thread, and returns when all are
       done. At most `threads` tasks run at a time. Default NULL: OpenMP if the compiler has it, otherwise one after the
       other. Not saved. */
    void (*parallel)(void *user, int tasks, void (*task)(void *context, int index), void *context);
    void *parallel_user;
    /* Called now and then, on the calling thread, while dem_fill, dem_fill_mass and the feeds look for places. A result
       other than 0 ends the call with DEM_STOPPED, and nothing has changed. It may read the world. Default NULL.
       dem_run needs none: call it with short durations. Not saved. */
    int (*stop)(void *user);
    void *stop_user;
    dem_material material[DEM_MATERIALS_MAX];
    dem_pair_def pair[DEM_MATERIALS_MAX][DEM_MATERIALS_MAX]; /* [smaller index][larger index]; dem_pair() returns it */
} dem_def;

/* ---- walls ---- */

typedef enum dem_profile {
    DEM_ROUND,     /* full round wires */
    DEM_SEMICIRCLE /* round above, flat below: the cross-section is the upper half of a circle */
} dem_profile;

/* A woven screen: two crossing families of bars in one plane, with square apertures. Made by dem_default_screen(). */
typedef struct dem_screen {
    double aperture;     /* clear width between bars [m] > 0; default 8e-3 */
    double wire;         /* width of a bar [m] > 0; default 2e-3 */
    dem_profile profile; /* default DEM_SEMICIRCLE */
    int circular;        /* 1: disc of radius half_x; 0: rectangle; default 1 */
    double half_x; /* radius, or half length along x [m] > 0; default 0.095. With (n + 1/2) pitches a bar lies along the
                      edge */
    double half_y; /* half length along y [m] > 0 if rectangular */
    dem_vec
        centre; /* centre of the deck, in the plane of the wire axes and in the middle of an aperture [m]; default 0 */
    dem_vec normal;    /* up; default (0, 0, 1) */
    dem_vec direction; /* along one family of bars; made perpendicular to the normal; default (1, 0, 0) */
} dem_screen;

/* The lateral surface of a frustum or, with equal radii, a tube of finite length: a thin sheet, touched from inside,
   from outside and at its rims. Made by dem_default_cone(). */
typedef struct dem_cone {
    dem_vec low, high;  /* centres of its ends [m], not equal; default 0 and (0, 0, 0.1) */
    double low_radius;  /* at low [m] >= 0; 0 makes a tip; default 0.02 */
    double high_radius; /* at high [m] >= 0, not both 0; default 0.1 */
} dem_cone;

/* A flat disc, with or without a round hole in its middle: a thin sheet, touched from both sides and at its rims. Made
   by dem_default_disc(). */
typedef struct dem_disc {
    dem_vec centre;     /* [m]; default 0 */
    dem_vec normal;     /* of any length but 0; default (0, 0, 1) */
    double radius;      /* [m] > 0; default 0.1 */
    double hole_radius; /* of the hole [m] >= 0, less than radius; default 0: no hole */
} dem_disc;

typedef enum dem_wall_kind {
    DEM_PLANE,
    DEM_CYLINDER,
    DEM_SCREEN,
    DEM_EXIT,
    DEM_SPHERE,
    DEM_CONE,
    DEM_MESH,
    DEM_DISC
} dem_wall_kind;

/* Triangles, your own or read by dem_read_stl(). For your own arrays, set the first four fields; the others are 0. */
typedef struct dem_mesh {
    ptrdiff_t vertices, triangles; /* at most INT32_MAX / 4 */
    double *vertex;                /* shape [vertices][3] [m] */
    int32_t *triangle;             /* shape [triangles][3]: indices of vertices */
    dem_allocator allocator;       /* that allocated the block */
    void *block;                   /* what dem_free_mesh() frees */
    size_t bytes;
} dem_mesh;

/* What dem_read_stl() found in a file. For a closed, well made surface all counts from `missing` to `wrong_normals` are
   0. */
typedef struct dem_stl_report {
    int binary;         /* 1: binary, 0: text */
    ptrdiff_t facets;   /* whole triangles in the file; a facet of n corners counts as the n - 2 triangles into which it
                           is cut */
    ptrdiff_t polygons; /* facets of more than three corners */
    ptrdiff_t missing;  /* facets that are announced by a binary file and absent, cut off or garbled in a text, or not
                           covered by a fan of triangles; 1 more if a text that begins with "solid" lacks "endsolid" */
    ptrdiff_t unannounced;   /* facets of a binary file beyond its count; read, because the file ends with a whole
                                one */
    ptrdiff_t surplus;       /* bytes of a binary file after its facets; not read */
    ptrdiff_t not_finite;    /* left out: a coordinate is NaN or infinite */
    ptrdiff_t degenerate;    /* left out: no area after welding; where one closes a T-junction there is no hole */
    ptrdiff_t duplicate;     /* left out: the same corners as an earlier one */
    ptrdiff_t open_edges;    /* edges of one triangle only: the rims of holes */
    ptrdiff_t nonmanifold;   /* edges of more than two triangles */
    ptrdiff_t inconsistent;  /* edges whose two triangles have opposite orientations */
    ptrdiff_t wrong_normals; /* stored normals more than 60 degrees off the triangle's own; normals of length 0 do not
                                count */
    double area;             /* [m2] */
    double volume;           /* [m3] of a closed surface, negative if it is inside out; meaningless with open edges */
    dem_vec low, high;       /* corners of its bounding box [m] */
} dem_stl_report;

/* Pose of a wall in a prescribed motion: turned about the centre given to dem_prescribe(), then shifted. */
typedef struct dem_pose {
    dem_vec shift; /* [m] */
    dem_vec turn;  /* axis times angle [rad] */
} dem_pose;
/* Motion of a wall: a pure function of time [s] (and of *user, which must not change), as smooth as the motion of a
   body is. It is called for times in any order, including one time step before and after the run. *pose is zero at
   entry. */
typedef void (*dem_motion_fn)(void *user, double time, dem_pose *pose);

typedef enum dem_drive {
    DEM_KINEMATIC,        /* at rest, or by dem_vibrate, dem_move, dem_rotate */
    DEM_PRESCRIBED,       /* dem_prescribe */
    DEM_FORCE_CONTROLLED, /* dem_control_force */
    DEM_TORQUE_CONTROLLED /* dem_control_torque */
} dem_drive;

struct dem__tree;
struct dem__wall_kind;

/* The motion of a wall as the functions that move walls set it. */
typedef struct dem_wall_motion {
    int drive;                    /* dem_drive */
    dem_vec origin, rest_axis[3]; /* position and axes of the wall when the motion began [m] */
    double motion_start;          /* time at which the motion began; controlled: time of the coordinate [s] */
    dem_vec amplitude,
        phase;           /* vibration: displacement A (sin(2 pi f t + phase) - sin(phase)) by component [m], [rad] */
    double frequency;    /* [Hz] */
    dem_vec drift;       /* constant velocity [m/s] */
    dem_vec spin_centre; /* centre of a rotation [m] */
    dem_vec belt;        /* velocity of its surface within itself [m/s] */
    dem_vec belt_turn;   /* the same around pulleys: axis times speed; the surface moves along its cross product with
                            the normal [m/s] */
    double inertia, load, damping; /* controlled: [kg], [N], [N s/m] or [kg m2], [N m], [N m s/rad] */
    dem_motion_fn motion;          /* prescribed */
    void *motion_user;
    double interval; /* prescribed: interval of the finite differences [s] */
} dem_wall_motion;

/* A wall: its shape, the motion that was set, and its present state. Read only; functions change it. */
typedef struct dem_wall {
    int kind, material, enabled;
    double radius;              /* cylinder, sphere; cone: at its low end, which is the origin; disc: of its hole [m] */
    double high_radius, length; /* cone: radius at the other end, distance of the ends; disc: radius, 0 [m] */
    int inside;                 /* cylinder, sphere: 1 if particles are inside, 0 if outside */
    double aperture, wire;      /* screen [m] */
    int profile, circular;      /* screen */
    double half_x, half_y;      /* screen [m] */
    struct dem__tree *tree;     /* mesh: the triangles, owned */
    int solid;                  /* mesh: 1: a closed body with an occupied inside; 0: a sheet */
    uint32_t groups;            /* bit g: acts on particles of group g; bit 31: on those of all other groups; set by
                                   dem_set_wall_groups */

    dem_wall_motion asked;

    dem_vec axis[3]; /* axes of its own frame in the world's; axis[2] is the normal or the cylinder's axis */
    dem_vec position, velocity, acceleration; /* of its origin */
    dem_vec spin_axis;                        /* axis of its rotation; controlled: of the motion */
    double spin, spin_rate;                   /* [rad/s], [rad/s2] */
    double coordinate, rate,
        rate_change;         /* controlled: distance [m] or angle [rad] since control began, and its derivatives */
    dem_vec force, torque;   /* on the wall in this step [N], about its origin [N m]; use the impulse for means */
    dem_vec impulse;         /* time integral of the force [N s] */
    dem_vec angular_impulse; /* time integral of the torque about the world's origin [N m s]; see
                                dem_wall_angular_impulse */
    double work;             /* done on the particles by its motion and its belt [J] */

    const struct dem__wall_kind *kind__; /* private: the functions of its kind */
    int slides;                          /* private: 1 if its surface moves unlike its origin */
    double speed_bound, spin_bound;      /* private: limits of its origin's speed, apart from rotation, and of its spin,
                                            until timers are reset */
    double acceleration_bound; /* private: kinematic: limit of the acceleration of its origin, apart from rotation
                                       [m/s2] */
    double side_bound;         /* private: the same perpendicular to axis[2] */
    dem_vec phase_sine;        /* private: sine of the vibration's phase, by component */
} dem_wall;

/* A particle that passed an exit. Owned by the world, in the order of passing. */
typedef struct dem_passed {
    double time;     /* end of the step in which the centre crossed [s] */
    double diameter; /* [m]; the mass is density pi/6 diameter^3; groups tell several materials apart */
    dem_vec position, velocity;
    uint64_t id;
    int32_t group, exit; /* the number given to dem_add_spheres; index of the exit */
} dem_passed;

/* ---- laws ---- */

/* For laws of your own: dem_prepare_linear and dem_force_linear, dem_force_linear_friction, dem_force_linear_rolling
   (states, history, vectors: 0, 0, 0; with friction 3, 3, 1); the same for hertz (0, 0, 0; 4, 4, 1). Their constants
   come first; yours follow (docs/dem.md). */
enum { DEM_LINEAR_CONSTANTS = 8, DEM_HERTZ_CONSTANTS = 8 };

/* ---- force fields ---- */

struct dem__seen;

/* Input of the law of a force field for one particle. For one of your own: all 0, then the members that count. */
typedef struct dem_force_point {
    dem_vec position; /* of its centre, within the periodic box [m] */
    dem_vec velocity; /* [m/s] */
    double radius;    /* [m] */
    double mass;      /* [kg] */
    double time;      /* [s] */
    dem_vec gravity;  /* [m/s2] */
    const void *user; /* the user of the field */
    const struct dem__seen *body__; /* private: the body whose shape dem_sphericities() finds; NULL: a sphere */
} dem_force_point;

struct dem__field_task;
typedef int (*dem_field_fn)(struct dem_world *world, const struct dem__field_task *task); /* made by DEM_FORCE_FIELD */

/* A force on every particle, in flight or in contact. Made by dem_default_force_field(), copied by
   dem_set_force_field(). */
typedef struct dem_force_field {
    dem_field_fn
        kernel; /* made from a law by DEM_FORCE_FIELD(name, law); the law: dem_vec law(const dem_force_point *at) [N] */
    const void *user; /* passed to the law; default NULL */
    double length; /* longest distance of one step in flight [m] > 0: half the size of the finest detail; default
                      HUGE_VAL */
    double interval; /* longest time of one step in flight [s] > 0: a tenth of the time in which the field changes;
                        default HUGE_VAL */
    double accuracy; /* largest error of position in one step in flight, over the particle's radius [-] 1e-12 .. 1e-4;
                        default 1e-6 */
} dem_force_field;

/* The shape of a rigid body for dem_drag_hoelzer_sommerfeld: */
typedef enum dem_drag_shape {
    DEM_DRAG_BY_ORIENTATION, /* its own, as the flow meets it: sphericity, crosswise and lengthwise sphericity */
    DEM_DRAG_BY_SPHERICITY,  /* its own sphericity for all three: the mean of all orientations of a convex body */
    DEM_DRAG_SHARED          /* dem_gas.shape, as for a sphere */
} dem_drag_shape;

/* A gas: at rest, or given by values on a Cartesian grid, in a frame that may move. Made by dem_default_gas(); the
   arrays are the caller's. */
typedef struct dem_gas {
    double density;   /* [kg/m3] > 0; default 1.2 */
    double viscosity; /* [Pa s] > 0; default 1.81e-5 */
    double shape[3];  /* of spheres: C1, C2, C3 of the drag coefficient C1/Re + C2/sqrt(Re) + C3 for
                         dem_drag_hoelzer_sommerfeld; default 24, 3, 0.42 */
    int bodies;       /* dem_drag_shape: the shape of polyhedra and clumps; default DEM_DRAG_BY_ORIENTATION */
    int buoyancy; /* 1: subtracts the weight of the displaced gas; 0 if pressure_gradient contains the gas's own weight;
                     default 0 */
    dem_vec low, high;      /* corners of the grid in the frame [m], no gas beyond; default -HUGE_VAL, HUGE_VAL */
    int n[3];               /* number of nodes along each axis, corners included, >= 2 where there are values */
    const double *velocity; /* at the nodes, relative to the frame, in its axes [m/s], shape [n[2]][n[1]][n[0]][3];
                               NULL: at rest */
    const double
        *pressure_gradient; /* at the nodes, in its axes [Pa/m], same shape; its force -V grad p is added; NULL: none */
    const double *porosity; /* at the nodes [-], 0 < .. <= 1, shape [n[2]][n[1]][n[0]]; NULL: 1 */
    dem_vec centre, axis,
        drift; /* the frame turns about `axis` through `centre` [m], which moves at `drift` [m/s]; 0, (0, 0, 1), 0 */
    double spin, start; /* rate of this rotation [rad/s]; time at which frame and world coincide [s]; default 0 */
    const dem_force_point *point__; /* private: for a law of drag: the body, and how the gas flows about it */
    dem_vec flow__;
} dem_gas;

/* ---- the world ---- */

/* Present energies, and where energy went [J]; sums since the first run with DEM_ENERGY. */
typedef struct dem_energy_ledger {
    double kinetic, rotational, elastic, potential; /* at present; the potential energy is that of gravity, 0 at the
                                                       origin */
    double normal_loss, sliding_loss, rolling_loss; /* dissipated, as the laws compute it */
    double wall_work, external_work; /* done on the particles: by moving walls; by loads and moving fixed particles */
    double field_work;               /* done on the particles by a force field */
    double link_work; /* done on the particles by links: minus what links store and lost, apart from the work of walls
                         through them */
    double added, removed; /* carried in and out by particles, and by changes of the caller between runs: contacts that
                              begin, end or get other constants, gravity */
    double start, start_potential, added_potential,
        removed_potential; /* energy when the ledger began; the potential parts */
    double released;       /* potential energy released so far, at least 0 */
    double error;          /* remainder of the balance: the integration error */
} dem_energy_ledger;

/* A body: a sphere, or several particles that move as one. The particles of a body are consecutive in the arrays of the
   world; each has the mass of the body (dem_particle.mass). */
typedef struct dem_body {
    ptrdiff_t first, pieces;    /* its particles */
    double mass;                /* [kg] */
    double diameter;            /* of a sphere with that mass and the material of the first particle [m] */
    dem_vec position, velocity; /* of the centre of mass [m], [m/s] */
    dem_vec spin;               /* [rad/s], along the world's axes */
    dem_quaternion orientation; /* from the frame in which its shape was given; a sphere: 1, 0, 0, 0 */
    dem_vec moments;            /* of inertia, about the principal axes [kg m2] */
    dem_quaternion axes;        /* from the principal axes to the world's */
} dem_body;

/* A sphere as the engine keeps it: radius, mass, and the state at its own origin step, which may be long past. From
   there it moves by x + v t + a t^2/2. dem_position(), dem_velocity() and dem_spin() return the present state. In a
   law's hooks v and spin are those in the middle of the step. Two cache lines, which are what contacts read. */
typedef struct dem_particle {
    dem_vec x;               /* [m] */
    double radius;           /* [m] */
    dem_vec v;               /* [m/s] */
    double mass;             /* [kg] */
    dem_vec a;               /* [m/s2] */
    int64_t origin;          /* step of the state */
    dem_vec spin;            /* [rad/s] */
    double tolerance_left__; /* private: by how much its velocity can change at least before it may leave its bound
                                [m/s] */
} dem_particle;

enum { DEM_LEAVING = -1, DEM_GONE = 0, DEM_PRESENT = 1 };

/* Spheres, walls and contacts at one time. Owned by the caller, filled by dem_init. Fields are read only unless a
   function says otherwise; arrays have `count` entries and stay valid until the next call that adds, removes or
   runs. */
typedef struct dem_world {
    dem_def def;
    void *user;      /* the caller's: passed to the law's hooks; not saved */
    int64_t step;    /* steps done */
    double time;     /* [s] */
    double owed;     /* time requested and not yet run, at most half a step [s]; the next run makes up for it. 0 after a
                        failed run: then request the rest again */
    ptrdiff_t count; /* entries of the arrays; a particle that left stays, with alive = DEM_GONE, until the gaps are
                        closed */
    dem_status status; /* first failure of a run; failed_id and step then name the particle and the step */
    uint64_t failed_id;
    int failed_pair[2]; /* with DEM_PAIR_NOT_SET: the two materials, the smaller index first */
    const char *refusal; /* what dem_error_text() returns; NULL: nothing; not saved */
    int walls;
    dem_wall *wall;
    ptrdiff_t passed_count; /* records kept until dem_take_passed() takes them */
    int64_t passed_total;   /* particles that ever passed an exit */
    dem_passed *passed;
    int64_t particle_steps; /* sum over steps of particles present */
    int64_t contact_steps;  /* sum over steps of contacts present */
    int64_t looks;          /* tests of pairs and of particles with walls */
    int64_t rebuilds;       /* of the neighbour list */
    double step_ratio; /* time step over the largest stable one; 0 before the first run. Computed when a run begins
                          after a change, for the smallest and stiffest present pair (a body has its least effective
                          mass). Contacts that begin later raise it if their law's prepare function returns a
                          stiffness. Above 1 contacts create energy; dem_advise() advises 0.25 or less. With DEM_HERTZ,
                          whose contacts stiffen in an impact, it follows from the time of Rayleigh waves alone. Links
                          are not included: the caller chooses their interval */

    dem_particle *particle; /* states at origin steps; dem_position() and the like return present ones */
    dem_vec *spin_rate;     /* since the origin step [rad/s2] */
    uint64_t *id;           /* never changes; counts up from 0 in the order of adding */
    int32_t *material, *group;
    int32_t *alive;    /* DEM_PRESENT, DEM_GONE; within a step DEM_LEAVING */
    int32_t *touching; /* number of its contacts */

    struct dem__engine *engine; /* private */
} dem_world;
