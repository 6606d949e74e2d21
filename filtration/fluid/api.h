/* The resolved fluid as its user sees it: definition, spheres, solid, state, steps, measuring, saving. */
#pragma once
#include "../base/base.h"
#include "../solids/solids_api.h"

/* ==== >>fluid ==== */

/* Law at a lattice link from a fluid node to a solid one, which the surface of a sphere, a wire or a wall cuts at the
   fraction q of its length. */
typedef enum filtration_boundary {
    FILTRATION_CENTRAL_LINEAR, /* central linear interpolation (Ginzburg et al. 2008): second order; default */
    FILTRATION_HALF_WAY        /* half-way bounce-back (Ladd 1994): q = 1/2 wherever the surface is, so that it becomes
                                  a staircase */
} filtration_boundary;

/* How a node that a sphere leaves is filled. */
typedef enum filtration_refill {
    FILTRATION_REFILL_NONEQUILIBRIUM, /* equilibrium at the density of the neighbours and the wall's velocity, plus the
                                         non-equilibrium part of the fluid neighbour along the normal; default */
    FILTRATION_REFILL_EQUILIBRIUM,    /* without the non-equilibrium part */
    FILTRATION_REFILL_INTERPOLATION   /* mean of the fluid neighbours' populations (the paper's) */
} filtration_refill;

/* How the fluid's force on a sphere is measured. */
typedef enum filtration_force_mode {
    FILTRATION_MOMENTUM_EXCHANGE, /* sum over the links, Galilean invariant (Wen et al. 2014), mean of two
                                     steps; default */
    /* the paper's (9): shear over a layer of one voxel, without pressure; for comparison: its bias is -1.5 dx / R */
    FILTRATION_SHEAR_LAYER
} filtration_force_mode;

typedef enum filtration_lattice { FILTRATION_D3Q19, FILTRATION_D3Q15 } filtration_lattice;
/* of the stored populations */
typedef enum filtration_precision { FILTRATION_DOUBLE, FILTRATION_FLOAT } filtration_precision;

/* Kinds of the box's six faces. Periodic faces come in pairs. */
typedef enum filtration_face {
    FILTRATION_PERIODIC,
    FILTRATION_WALL,     /* no slip; at the face, which may move within its plane */
    FILTRATION_PRESSURE, /* open, at a given pressure */
    FILTRATION_SYMMETRY, /* a mirror: no flow through it, no shear on it. A sphere that it cuts gets the force on the
                            part inside the box, without that of a constant pressure */
    FILTRATION_INFLOW, /* liquid enters or leaves with face_velocity; the box also needs a PRESSURE or OUTLET face
                          unless inflow and outflow are equal */
    FILTRATION_OUTLET  /* open, at a given pressure, for jets and vortices that leave. Where liquid comes back in, the
                          pressure is less by rho u^2 / 2, as from a vessel at rest: backflow brings no energy. At a
                          PRESSURE face a strong backflow grows until the run diverges */
} filtration_face;
enum { FILTRATION_LOW_X, FILTRATION_HIGH_X, FILTRATION_LOW_Y, FILTRATION_HIGH_Y, FILTRATION_LOW_Z, FILTRATION_HIGH_Z };

/* Everything that does not change in time. Made by filtration_fluid_default_def(). The box extends from 0 to nodes[a] *
   voxel along each axis; node i lies at (i + 1/2) voxel. */
typedef struct filtration_fluid_def {
    uint32_t cookie;   /* set by filtration_fluid_default_def(); a definition without it is refused */
    int nodes[3];      /* number along x, y, z, each >= 1; below 2^31 in all; default 32, 32, 32. Rows of 64 nodes and
                          more along x are fastest */
    double voxel;      /* distance of nodes [m], 1e-15 .. 1e15; default 2.5e-6 */
    double density;    /* of the fluid [kg/m3], 1e-15 .. 1e15; default 1000 */
    double viscosity;  /* dynamic [Pa s], 1e-15 .. 1e15; default 1e-3 */
    double tau;        /* relaxation time [-], 0.5 < tau <= 20; default 1. It sets the time step (tau - 1/2)
                          voxel^2 / (3 nu) */
    double bulk_ratio; /* bulk viscosity over kinematic viscosity [-], >= 0; default 2/3: no third rate. Larger values
                          damp sound; keep below about 100 if spheres move */
    double magic;      /* Lambda of the two relaxation times [-] > 0; default 3/16, which makes walls half way between
                          nodes exact; HUGE_VAL: one relaxation time (BGK) */
    filtration_lattice lattice;     /* default D3Q19; D3Q15 is stored in doubles only */
    filtration_precision precision; /* default DOUBLE */
    filtration_boundary boundary;   /* default CENTRAL_LINEAR */
    filtration_refill refill;       /* default NONEQUILIBRIUM */
    filtration_force_mode force;    /* default MOMENTUM_EXCHANGE */
    filtration_face face[6];        /* FILTRATION_LOW_X ...; default PERIODIC */
    double face_velocity[6][3];     /* of WALL faces, within their plane, and of INFLOW faces [m/s]; default 0 */
    double face_pressure[6];        /* of PRESSURE and OUTLET faces [Pa], relative to the mean; default 0 */
    double body_force[3];           /* on the fluid [N/m3]; default 0. Without gravity, because pressure is dynamic */
    filtration_solid solid;         /* default: none */
    double speed_limit;             /* lattice speed [-] above which a run stops as diverged, 1e-15 .. 0.5; default
                                       0.3 */
    int keep_mass;                  /* 1: filtration_fluid_keep_mass is called every 256 steps of a closed box with
                                       moving spheres; default 1 */
    int skip;                       /* 1: slabs that are all solid, or fluid at exact rest, are not updated; 0: all are;
                                       same bits; default 1 */
    int threads;                    /* number of threads >= 1; default 1; same bits for any number */
    filtration_parallel parallel;   /* default: OpenMP if the compiler has it */
    filtration_memory memory;       /* default: realloc and free */
} filtration_fluid_def;

/* Spheres, in arrays of the caller. A step reads the first four arrays and writes force and torque. */
typedef struct filtration_spheres {
    ptrdiff_t n;      /* number, >= 0; may grow from step to step */
    double *centre;   /* [n][3] [m]; anywhere on periodic axes */
    double *velocity; /* [n][3] [m/s] */
    double *spin;     /* [n][3] angular velocity [rad/s] */
    double *radius;   /* [n] [m] > 0; 0: no sphere at this index */
    double *force;    /* [n][3] force of the fluid on the sphere [N], without buoyancy (pressure is dynamic); a constant
                         pressure exerts none */
    double *torque;   /* [n][3] about the centre [N m] */
} filtration_spheres;

/* Causes for which a run stopped. */
#define FILTRATION_CAUSES(X)                                                                                           \
    X(FILTRATION_NO_CAUSE, "nothing is wrong")                                                                         \
    X(FILTRATION_NOT_FINITE, "a population is infinite or not a number")                                               \
    X(FILTRATION_SPEED, "the speed exceeds the limit: smaller tau, or finer voxels")                                   \
    X(FILTRATION_SPHERE, "a sphere's centre, velocity, spin or radius is out of range")
typedef enum filtration_cause { FILTRATION_CAUSES(FILTRATION__ENUM) FILTRATION_CAUSE_COUNT } filtration_cause;
FILTRATION_API const char *filtration_cause_text(filtration_cause cause); /* never NULL; static storage */

typedef struct filtration_problem {
    filtration_cause cause;
    int node[3];          /* the first bad node in the order of z, y, x; with FILTRATION_SPHERE: {index of the
                             sphere, 0, 0} */
    int64_t step;         /* step at which it was found */
    double speed;         /* speed there, in lattice units [-] */
    const char *rule;     /* with FILTRATION_SPHERE: what it has to be; static storage; otherwise NULL */
    double cell_reynolds; /* u dx / nu there [-]; above 20 to 30 the flow between two nodes is not resolved */
} filtration_problem;

struct filtration__lattice;

/* The state of the fluid. Its fields are read only; functions change it. */
typedef struct filtration_fluid {
    filtration_fluid_def def;            /* a copy of the definition, with the present tau, body_force and faces */
    double time;                         /* [s] */
    double dt;                           /* time step [s] */
    int64_t steps;                       /* number of steps taken */
    double mass_correction;              /* density that filtration_fluid_keep_mass has added so far, over
                                            def.density [-] */
    int64_t updates;                     /* number of node updates so far, without skipped ones */
    filtration_problem problem;          /* of the last step */
    struct filtration__lattice *lattice; /* private */
} filtration_fluid;

FILTRATION_API filtration_fluid_def filtration_fluid_default_def(void);
/* Returns BAD_DEF if a field is out of range; then *field (may be NULL) is its name, in static storage. */
FILTRATION_API filtration_status filtration_fluid_check_def(const filtration_fluid_def *def, const char **field);
/* Makes a fluid at rest. A fluid in use must be freed first. After an error *fluid is empty and may be freed. BAD_DEF,
   NO_MEMORY. */
FILTRATION_API filtration_status filtration_fluid_init(filtration_fluid *fluid, const filtration_fluid_def *def);
FILTRATION_API void filtration_fluid_free(filtration_fluid *fluid);
/* Returns the memory that a definition will allocate, without spheres and links [B]; 0 for an invalid one. */
FILTRATION_API double filtration_fluid_bytes(const filtration_fluid_def *def);

/* Takes one time step: the fluid flows around the spheres at their present positions, and force and torque are set to
   those of this step. Then the caller moves the spheres by fluid->dt and steps again. spheres may be NULL: none.
   BAD_ARGUMENT, NO_MEMORY, TOO_FAST, DIVERGED. A step tests the flow with which it begins; the next step tests what a
   force, a face or a sphere makes of it. After an error the fluid can be read, saved and freed. */
FILTRATION_API filtration_status filtration_fluid_step(filtration_fluid *fluid, const filtration_spheres *spheres);
/* Takes steps >= 0 with spheres whose centres stay in place; their surfaces move with their velocity and spin. */
FILTRATION_API filtration_status filtration_fluid_run(filtration_fluid *fluid, int64_t steps,
                                                      const filtration_spheres *spheres);

/* ---- changes during a run: BAD_ARGUMENT, and nothing changes, where a value is out of range. Velocities of
   faces [voxel / dt], pressures [density voxel^2 / dt^2 / 3] and forces [density voxel / dt^2] stay below 1000. ---- */
/* Sets tau, and with it the time step, and rescales the flow: velocity, pressure and stress keep their SI values.
   Adopts changes of bulk_ratio and magic that the caller has made in fluid->def. */
FILTRATION_API filtration_status filtration_fluid_set_tau(filtration_fluid *fluid, double tau);
/* Sets the force on the fluid [N/m3], or a face's pressure [Pa] or velocity [m/s]. */
FILTRATION_API filtration_status filtration_fluid_set_body_force(filtration_fluid *fluid, const double force[3]);
FILTRATION_API filtration_status filtration_fluid_set_face_pressure(filtration_fluid *fluid, int face, double pressure);
FILTRATION_API filtration_status filtration_fluid_set_face_velocity(filtration_fluid *fluid, int face,
                                                                    const double velocity[3]);
/* Sets the initial flow. fn gives velocity [m/s] and pressure [Pa] at a point [m]. It is called twice for every point.
   Populations are the equilibrium plus the stress from the differences of velocity. */
FILTRATION_API filtration_status filtration_fluid_set_flow(filtration_fluid *fluid,
                                                           void (*fn)(void *user, const double point[3],
                                                                      double velocity[3], double *pressure),
                                                           void *user);
/* Adds the same density to every fluid node, so that its mean is def.density. This compensates for nodes that spheres
   cover and leave. For closed boxes; mass_correction is the sum of all that was added. DIVERGED if the mass is not a
   number. */
FILTRATION_API filtration_status filtration_fluid_keep_mass(filtration_fluid *fluid);

/* ---- measuring ---- */
typedef struct filtration_sample {
    double velocity[3]; /* [m/s]; 0 in solids */
    double pressure;    /* dynamic, over the mean [Pa]; 0 in solids */
    int owner;          /* -1 fluid, -2 solid, otherwise the index of the sphere */
} filtration_sample;
/* Samples node (x, y, z), each 0 .. nodes - 1; otherwise BAD_ARGUMENT. */
FILTRATION_API filtration_status filtration_fluid_at(const filtration_fluid *fluid, int x, int y, int z,
                                                     filtration_sample *sample);
/* Copies whole fields into arrays of the caller, x fastest; each may be NULL: velocity [nz][ny][nx][3], pressure
   [nz][ny][nx], owner [nz][ny][nx]. */
FILTRATION_API void filtration_fluid_fields(const filtration_fluid *fluid, float *velocity, float *pressure,
                                            int32_t *owner);
/* Computes the superficial velocity [m/s]: the mean over the whole box, with 0 in solids. */
FILTRATION_API void filtration_fluid_mean_velocity(const filtration_fluid *fluid, double velocity[3]);
/* Returns the superficial velocity [m/s] along an axis (0 x, 1 y, 2 z): volume flow through a slab of nodes over the
   box's cross-section. */
FILTRATION_API double filtration_fluid_flux(const filtration_fluid *fluid, int axis, int slab);
/* of the liquid [kg] */
FILTRATION_API double filtration_fluid_mass(const filtration_fluid *fluid);
/* share of fluid nodes [-] */
FILTRATION_API double filtration_fluid_porosity(const filtration_fluid *fluid);
/* On def.solid in the last step [N]. */
FILTRATION_API void filtration_fluid_solid_force(const filtration_fluid *fluid, double force[3]);
FILTRATION_API double filtration_fluid_max_speed(const filtration_fluid *fluid);                  /* [m/s] */

/* ---- saving: the caller's functions write and read bytes and return 0 to refuse. A loaded run continues with
   the same bits. */
typedef int (*filtration_write_fn)(void *user, const void *data, size_t bytes);
typedef int (*filtration_read_fn)(void *user, void *data, size_t bytes);
FILTRATION_API filtration_status filtration_fluid_save(const filtration_fluid *fluid, filtration_write_fn write,
                                                       void *user);
/* Loads into a fluid that filtration_fluid_init made with the same definition (box, lattice, precision, faces, solid,
   laws); BAD_DATA for another one. After BAD_DATA or STREAM the fluid is at rest at time 0. */
FILTRATION_API filtration_status filtration_fluid_load(filtration_fluid *fluid, filtration_read_fn read, void *user);

/* ==== >>motion: spheres moved by a fluid, without another particle code ==== */

typedef struct filtration_motion_def {
    uint32_t cookie;
    double density;     /* of the spheres [kg/m3], at least 0.4 times the fluid's, because the liquid that they displace
                           tosses lighter ones about; default 2200 */
    double gravity[3];  /* [m/s2]; default (0, 0, -9.81); acts as buoyant weight (density - fluid density) V g */
    double modulus;     /* reduced modulus E* of two spheres in contact [Pa] > 0; default 1e8 (softened;
                           docs/filtration.md) */
    double restitution; /* coefficient of restitution of a dry contact [-], above 0 .. 1; default 0.5 */
    double friction;    /* Coulomb coefficient [-] >= 0; default 0.3 */
    int sub_steps;      /* contact steps in a fluid step, 1 .. 1000000; default 10 */
    int lubrication;    /* 1: adds the force of films thinner than 2/3 voxel, for pairs, the solid and
                           walls; default 1 */
    double least_gap;   /* smallest gap of lubrication, over the diameter [-] > 0; default 1e-3: roughness */
    int fixed_axes[3];  /* 1: no motion along this axis (symmetry); default 0 */
    int spin;           /* 0: spheres do not rotate; default 1 */
} filtration_motion_def;
FILTRATION_API filtration_motion_def filtration_motion_default_def(void);
FILTRATION_API filtration_status filtration_motion_check_def(const filtration_motion_def *def, const char **field);

/* Moves the spheres by one step of the fluid (leapfrog in sub_steps, at constant force and torque of the fluid):
   changes centre, velocity and spin. contact [n][3] (may be NULL): mean contact and lubrication force in the step [N].
   Spheres touch the fluid's walls and solid where these are. share: factor of the force in a box with symmetry faces
   (1, 2 or 4). BAD_DEF, BAD_ARGUMENT (also for spheres lighter than 0.4 of the fluid): nothing has moved; TOO_FAST: a
   contact gave a sphere an infinite speed (use more sub_steps). */
FILTRATION_API filtration_status filtration_move(const filtration_motion_def *def, const filtration_fluid *fluid,
                                                 filtration_spheres *spheres, double share, double *contact);
/* Returns the number of sub-steps in the contact time of two equal spheres (Hertz) [-]; it should be 10 or more. dt: of
   the fluid [s]; radius [m], speed of approach [m/s], all > 0, otherwise NaN. */
FILTRATION_API double filtration_contact_sub_steps(const filtration_motion_def *def, double dt, double radius,
                                                   double speed);
/* Returns the lubrication force along the normal on two spheres (r2 HUGE_VAL: a wall) [N], > 0 repulsive. gap [m];
   closing: approach velocity [m/s], > 0 closing; viscosity [Pa s]; cutoff: gap at which it begins [m]; least: smallest
   gap [m]. (Brenner 1961; Nguyen and Ladd 2002.) */
FILTRATION_API double filtration_lubrication_force(double r1, double r2, double gap, double closing, double viscosity,
                                                   double cutoff, double least);

/* ==== >>permeability: steady flow through any solid ==== */

typedef struct filtration_permeability_result {
    double permeability;  /* k = mu v / (pressure gradient) [m2] */
    double resistance;    /* dp / (mu v) over the box's length [1/m] */
    double velocity;      /* superficial, along the axis [m/s] */
    double pressure_drop; /* over the box [Pa] */
    double porosity;      /* of the box [-] */
    double reynolds;      /* largest speed * voxel / nu [-] */
    double change;        /* relative change of the velocity in the last test interval [-] */
    int64_t steps;        /* number taken */
} filtration_permeability_result;

/* Drives the fluid along an axis by pressure_drop [Pa] over the box, applied as a body force, until the flow changes by
   less than tolerance (0: 1e-5) in the time in which momentum spreads over the pores. spheres (may be NULL) are at
   rest. NOT_STEADY after max_steps. The flow remains in fluid and may be read. */
FILTRATION_API filtration_status filtration_fluid_permeability(filtration_fluid *fluid,
                                                               const filtration_spheres *spheres, int axis,
                                                               double pressure_drop, double tolerance,
                                                               int64_t max_steps,
                                                               filtration_permeability_result *result);
