/* dem.h - spheres in time: contact laws, walls and screens, neighbour search, integration.

       #include <stdio.h>

       #include "dem.h"

       int main(void) {
           dem_def def = dem_default_def();                      // SI units, every field documented below
           int glass = dem_add_material(&def, 2534.1, 50e9, 0.2);
           dem_pair(&def, glass, glass)->restitution = 0.78;
           def.dt = 4e-6;
           dem_world world;
           dem_status status = dem_init(&world, &def, NULL);     // names the first bad field
           double centre[3] = {0.0, 0.0, 0.1}, diameter = 0.005;
           dem_add_plane(&world, glass, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
           dem_add_spheres(&world, 1, centre, &diameter, glass, 0);
           if (status == DEM_OK) status = dem_run(&world, 0.5, DEM_LINEAR | DEM_FRICTION);
           printf("%s, height %g m\n", dem_status_text(status), dem_position(&world, 0).z);
           dem_free(&world);
           return status != DEM_OK;
       }

   Models    linear spring-dashpot, naive or clipped restitution (Schwager & Poeschel 2007); Hertz-Mindlin with damping from the
             coefficient of restitution (Tsuji et al. 1992); tangential spring with Coulomb limit (Cundall & Strack 1979); rolling
             resistance with a lever arm in metres, relative and capped. A law of your own: dem_law and DEM_KERNEL below.
   Walls     plane, cylinder, wire screen, cone, sphere, box, triangle mesh (STL); each at rest, vibrating, rotating, moving, prescribed
             or driven by a force or torque. A wall supplies geometry (normal, gap, surface velocity, inverse mass 0); everything after
             that is the pair's kernel.
   Time      A particle is on a parabola from the step at which its last force ended; only particles that touch something take steps.
             Velocity Verlet with the dashpot's velocity predicted and the first and last step of a contact resolved in time: second
             order in dt with damping, third for the restitution of a linear contact.
             A pair is not looked at before it can touch. Results do not depend on what is skipped, bit for bit.
   Filling   by size distribution without overlap, at once (dem_fill) or in time (dem_feed_mass); removing by region.
   Measuring regions, stress, coarse-grained fields (Goldhirsch 2010), histograms, residence, mixing: readers of a const world.
   Memory    The world owns all; one allocator hook; nothing is allocated in a step unless a capacity grows. 540 bytes a
             sphere and 12 more for every wall, 40 a near pair, 290 a contact with friction (64 more with a ledger), room for at least
             64 to 1024 of each and 6 near pairs a sphere, and half as much again for growing. Running out gives DEM_OUT_OF_MEMORY and
             a world that can be read, saved and freed.
   Threads   def.threads with OpenMP, else one. Same bits for any number. Worlds are independent of each other.
   Bits      The same on every machine that computes IEEE doubles, if compiled with -ffp-contract=off; dem_build_is_deterministic().
   Flags     -O2 is enough: with gcc the functions here bring their own options (#pragma GCC optimize, undone at the end), and with gcc
             and clang sqrt in a file that includes this does not set errno. A law of yours takes part if declared DEM_INLINE.
   Linking   one shared copy: #define DEM_API extern everywhere, DEM_IMPLEMENTATION as well in one file, which alone has DEM_KERNEL.
   Not here  non-spherical particles, fluids, heat, files, printing. */
#ifndef DEM_H
#define DEM_H

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "dem.h needs NaN and exact arithmetic: compile without -ffast-math and -ffinite-math-only"
#endif

#ifndef DEM_API
#define DEM_API static inline
#define DEM__BODIES
#elif defined(DEM_IMPLEMENTATION)
#define DEM__BODIES
#endif

/* From gcc -O1 on, but not at -Os, loops vectorise and no product is fused with a sum, whatever else a host is built with; clang fuses only
   if told to by -ffp-contract=fast. gcc leaves a loop scalar if a root in it may set errno or arithmetic may trap, and most at -O2. */
#if defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__NO_MATH_ERRNO__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wredundant-decls"
#ifdef __cplusplus
extern "C" double sqrt(double) noexcept(noexcept(::sqrt(1.0))) __attribute__((const));
#else
extern double sqrt(double) __attribute__((const));
#endif
#pragma GCC diagnostic pop
#endif
#if defined(__clang__)
#define DEM__FAST
#pragma float_control(push)
#pragma clang fp contract(off)
#elif defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__)
#define DEM__FAST __attribute__((optimize("O3", "no-math-errno", "no-trapping-math", "fp-contract=off")))
#pragma GCC push_options
#pragma GCC optimize("O3", "no-math-errno", "no-trapping-math", "fp-contract=off")
#else
#define DEM__FAST
#endif

#if defined(__GNUC__)
#define DEM_INLINE static inline __attribute__((always_inline)) DEM__FAST
#define DEM_RESTRICT __restrict__
#define DEM__APART __attribute__((noinline))
#elif defined(_MSC_VER)
#define DEM_INLINE static __forceinline
#define DEM_RESTRICT __restrict
#define DEM__APART
#else
#define DEM_INLINE static inline
#define DEM_RESTRICT
#define DEM__APART
#endif

/* Particles lie in any order: what is needed soon is asked for, into the second cache, as the first is full of what is in use. */
#if defined(__GNUC__)
#define DEM__PREFETCH(address) __builtin_prefetch(address, 0, 2)
#else
#define DEM__PREFETCH(address) ((void)(address))
#endif

/* What is new of a block of contacts goes straight to the world, as gcc can be told that no iteration reads what another writes. Clang
   takes that of the arrays within an iteration, too, and mixes up those of several: it gets rows that are seen to be nothing else's. A
   short loop gcc unrolls before it sees that it vectorises, if it is not told to leave it rolled. */
#if defined(__GNUC__) && !defined(__clang__)
#define DEM__INDEPENDENT _Pragma("GCC ivdep")
#define DEM__ROLLED _Pragma("GCC unroll 1")
#define DEM__IN_ROWS 0
#else
#define DEM__INDEPENDENT
#define DEM__ROLLED
#define DEM__IN_ROWS 1
#endif

/* On x86-64 the loops that vectorise are there twice, for AVX2 and without: same bits, as neither fuses. */
#if defined(__GNUC__) && defined(__x86_64__) && !defined(__AVX2__)
#define DEM__TWICE(name, parameters, arguments, call)                                                                                      \
    __attribute__((target("avx2"))) DEM__FAST static void name##_wide parameters { call; }                                                 \
    DEM__FAST static void name parameters {                                                                                                \
        if (__builtin_cpu_supports("avx2")) name##_wide arguments;                                                                         \
        else call;                                                                                                                         \
    }
#else
#define DEM__TWICE(name, parameters, arguments, call)                                                                                      \
    DEM__FAST static void name parameters { call; }
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------------------ >>types */

/* Tuning constants, each with its reason. */
#define DEM_MATERIALS_MAX 8                  /* a pair table of 64 entries stays in the definition */
#define DEM_WALLS_MAX 32                     /* walls are looked at by every particle near them; a mesh counts as one */
#define DEM_CONSTANTS_MAX 16                 /* constants of a law, folded per contact at its birth */
#define DEM_STATE_MAX 16                     /* doubles that a law may keep per contact */
#define DEM_KINDS_MAX 32                     /* sets of constants that contacts share: all of a few sizes and materials */
#define DEM_BLOCK 64                         /* contacts evaluated together: 30 arrays of a block fit the first-level cache */
#define DEM__FAR (1 << 20)                   /* steps that a list can last, and a look can be put off: rounding grows with them */
#define DEM__OFTEN 1024                      /* steps after which another look costs little: at turning walls nobody waits longer */
#define DEM__AHEAD 16                        /* looks for which memory is asked ahead */
#define DEM__BUNCH 16                        /* timers asked together whether any is due: a cache line */
#define DEM__SHEAF (DEM__BUNCH * DEM__BUNCH) /* timers of bunches asked together, likewise */
#define DEM__TIDY 256                        /* steps between two orderings of contacts */
#define DEM__LIST_STEPS 100 /* that a list should last: to find the near pairs takes about as long as thirty steps of a gas */
#define DEM__FEW_PAIRS 3    /* a sphere: where there are fewer a wide margin costs little, and lists should last four times as long */
#define DEM__SECTIONS 16    /* of the contacts, if they are many: more threads than that do not share them */
#define DEM__PARTS_MAX 256  /* threads that share a step: arrays of so many lie on the stack */
#define DEM_FORMAT 7u       /* version of dem_save */

#define DEM_STATUSES(X)                                                                                                                    \
    X(DEM_OK, "ok")                                                                                                                        \
    X(DEM_BAD_ARGUMENT, "an argument is outside its range")                                                                                \
    X(DEM_BAD_DEFINITION, "a field of the definition is outside its range")                                                                \
    X(DEM_OUT_OF_MEMORY, "out of memory")                                                                                                  \
    X(DEM_NOT_FINITE, "a particle's force or position is not finite")                                                                      \
    X(DEM_TOO_FAST, "a particle moves more than half its radius in one step")                                                              \
    X(DEM_TOO_MANY, "more walls, materials or particles than this header counts")                                                          \
    X(DEM_BAD_DATA, "saved data are damaged, of another version or of another byte count")                                                 \
    X(DEM_LAW_MISMATCH, "the law keeps another number of state variables than the contacts or links present, or links have no law: call "  \
                        "dem_set_links after dem_load")                                                                                    \
    X(DEM_NO_MOTION, "a wall's motion is a function, which dem_prescribe must name again after loading")
#define DEM__NAME(name, text) name,
typedef enum dem_status { DEM_STATUSES(DEM__NAME) DEM_STATUS_COUNT } dem_status;
#undef DEM__NAME

typedef struct dem_vec {
    double x, y, z;
} dem_vec;

/* What a run computes; or them together. Normal law: exactly one of DEM_LINEAR and DEM_HERTZ. */
enum {
    DEM_LINEAR = 1,   /* linear spring-dashpot */
    DEM_HERTZ = 2,    /* Hertz; with DEM_FRICTION, Mindlin's tangential stiffness */
    DEM_FRICTION = 4, /* tangential spring with Coulomb limit, torques */
    DEM_ROLLING = 8,  /* rolling resistance; needs DEM_FRICTION */
    DEM_ENERGY = 16   /* energy ledger, dem_energy() */
};

/* Layers of skipping; all on by default. They change no bit of a result, only the time it takes. */
enum {
    DEM_SKIP_PAIRS = 1, /* pairs are not looked at before they can touch */
    DEM_SKIP_SPACE = 2, /* walls are not looked at by particles that cannot reach them */
    DEM_SKIP_ALL = 3
};

/* How the dashpot of DEM_LINEAR follows from the coefficient of restitution. */
typedef enum dem_restitution {
    DEM_CLIPPED, /* the dashpot never pulls: contact ends when the force is zero (Schwager & Poeschel 2007) */
    DEM_NAIVE    /* the dashpot may pull at the end: contact ends when the overlap is zero */
} dem_restitution;

typedef struct dem_material {
    double density;       /* [kg/m3] > 0 */
    double young_modulus; /* [Pa] > 0; used by DEM_HERTZ and the Rayleigh time */
    double poisson_ratio; /* [-] 0 .. 0.5 */
} dem_material;

/* Parameters of contacts between two materials. */
typedef struct dem_pair_def {
    double stiffness;          /* k_n [N/m] > 0; DEM_LINEAR only; default 1e5 */
    double tangential_ratio;   /* k_t / k_n [-] 0 .. 1; DEM_LINEAR only; default 2/7 */
    double restitution;        /* coefficient of restitution e [-] 0 < e <= 1; default 0.8 */
    double friction;           /* Coulomb coefficient [-] >= 0; default 0.3 */
    double rolling;            /* lever arm of rolling resistance [m] >= 0; default 0 */
    double tangential_damping; /* tangential dashpot over the normal one [-] >= 0; default 0 */
    dem_restitution mode;      /* DEM_LINEAR only; default DEM_CLIPPED */
} dem_pair_def;

/* Memory. fn(user, old, old_size, new_size): new_size 0 frees; old NULL allocates; returns NULL when it cannot. */
typedef struct dem_allocator {
    void *(*fn)(void *user, void *old, size_t old_size, size_t new_size);
    void *user;
} dem_allocator;

/* Everything that does not change in time. Made by dem_default_def(). */
typedef struct dem_def {
    uint32_t cookie;         /* set by dem_default_def(); a definition without it is refused */
    int materials;           /* number of materials, by dem_add_material() */
    int threads;             /* >= 1; default 1; that of a world may be changed between runs */
    int skip;                /* DEM_SKIP_*; default DEM_SKIP_ALL */
    double dt;               /* time step [s] > 0; default 1e-6; dem_advise() tells a good one */
    double skin;             /* margin of the neighbour list over the smallest diameter [-] > 0; default 0.35. Up to three times as much is
                                taken where lists last under 100 steps (400 where pairs are few), less in a narrow periodic box */
    dem_vec gravity;         /* [m/s2]; default (0, 0, -9.81) */
    int periodic[3];         /* 1: that axis is periodic between low and high, over 2.2 of the largest diameters; default 0. Walls are not
                                repeated: let them reach a diameter past the box */
    dem_vec low, high;       /* [m]; used on periodic axes only; default 0 and 1 */
    dem_allocator allocator; /* default: realloc and free */
    dem_material material[DEM_MATERIALS_MAX];
    dem_pair_def pair[DEM_MATERIALS_MAX][DEM_MATERIALS_MAX]; /* [smaller index][larger index]; dem_pair() finds it */
} dem_def;

/* ---- walls ---- */

typedef enum dem_profile {
    DEM_ROUND,     /* full round wires */
    DEM_SEMICIRCLE /* round above, flat below: the section is the upper half of a circle */
} dem_profile;

/* A woven screen as two crossing families of bars in one plane, with square apertures. Made by dem_default_screen(). */
typedef struct dem_screen {
    double aperture;     /* clear width between bars [m] > 0; default 8e-3 */
    double wire;         /* width of a bar [m] > 0; default 2e-3 */
    dem_profile profile; /* default DEM_SEMICIRCLE */
    int circular;        /* 1: disc of radius half_x, 0: rectangle; default 1 */
    double half_x;       /* radius, or half length along x [m] > 0; default 0.095. (n + 1/2) pitches: a bar along the edge */
    double half_y;       /* half length along y [m] > 0 if rectangular */
    dem_vec centre;      /* centre of the deck in the plane of the wire axes, an aperture's centre [m]; default 0 */
    dem_vec normal;      /* up; default (0, 0, 1) */
    dem_vec direction;   /* along one family of bars, made perpendicular to the normal; default (1, 0, 0) */
} dem_screen;

/* A frustum's lateral surface, or with equal radii a tube of finite length: a thin sheet, touched from inside and outside and at its
   rims. Made by dem_default_cone(). */
typedef struct dem_cone {
    dem_vec low, high;  /* centres of its ends [m], apart; default 0 and (0, 0, 0.1) */
    double low_radius;  /* at low [m] >= 0, 0 makes a tip; default 0.02 */
    double high_radius; /* at high [m] >= 0, not both 0; default 0.1 */
} dem_cone;

typedef enum dem_wall_kind { DEM_PLANE, DEM_CYLINDER, DEM_SCREEN, DEM_EXIT, DEM_SPHERE, DEM_CONE, DEM_MESH } dem_wall_kind;

/* Triangles, yours or read by dem_read_stl(). For your own arrays: set the first four fields, the rest 0. */
typedef struct dem_mesh {
    ptrdiff_t vertices, triangles; /* at most INT32_MAX / 4 */
    double *vertex;                /* shape [vertices][3] [m] */
    int32_t *triangle;             /* shape [triangles][3]: indices of vertices */
    dem_allocator allocator;       /* of block */
    void *block;                   /* what dem_free_mesh() frees */
    size_t bytes;
} dem_mesh;

/* What dem_read_stl() found in a file. A closed, well made surface has zeros from `missing` to `wrong_normals`. */
typedef struct dem_stl_report {
    int binary;              /* 1: binary, 0: ASCII */
    ptrdiff_t facets;        /* present in the file and whole */
    ptrdiff_t missing;       /* facets that a binary file announces and does not hold, or that an ASCII file breaks off or garbles */
    ptrdiff_t not_finite;    /* left out: a coordinate is NaN or infinite */
    ptrdiff_t degenerate;    /* left out: without area, after welding */
    ptrdiff_t duplicate;     /* left out: the corners of an earlier one */
    ptrdiff_t open_edges;    /* of one triangle only: the rims of holes */
    ptrdiff_t nonmanifold;   /* edges of more than two triangles */
    ptrdiff_t inconsistent;  /* edges whose two triangles are turned against each other */
    ptrdiff_t wrong_normals; /* stored normals more than 60 degrees from the triangle's own; zero ones do not count */
    double area;             /* [m2] */
    double volume;           /* [m3] of a closed surface, negative if it is turned inside out; of no meaning with open edges */
    dem_vec low, high;       /* corners of the box that holds it [m] */
} dem_stl_report;

/* Where a prescribed motion has brought a wall: turned about the centre given to dem_prescribe(), then shifted. */
typedef struct dem_pose {
    dem_vec shift; /* [m] */
    dem_vec turn;  /* axis times angle [rad] */
} dem_pose;
/* A wall's motion: a pure function of time [s] (and of *user, which must not change), as smooth as the motion of a body is. It is asked
   for times in any order, one time step before and after the run included. *pose is zero at entry. */
typedef void (*dem_motion_fn)(void *user, double time, dem_pose *pose);

typedef enum dem_drive {
    DEM_KINEMATIC,        /* at rest, or by dem_vibrate, dem_move, dem_rotate */
    DEM_PRESCRIBED,       /* dem_prescribe */
    DEM_FORCE_CONTROLLED, /* dem_control_force */
    DEM_TORQUE_CONTROLLED /* dem_control_torque */
} dem_drive;

struct dem__tree;

/* A wall. Read only; change it by functions. */
typedef struct dem_wall {
    int kind, material, enabled;
    dem_vec origin;                       /* where it was put [m] */
    dem_vec axis[3];                      /* its own frame now, in the world's; axis[2] is normal or cylinder axis */
    dem_vec rest_axis[3];                 /* the same at time 0 */
    double radius;                        /* cylinder, sphere; cone: at its low end, the origin [m] */
    double high_radius, length;           /* cone: at the other end, distance of the ends [m] */
    int inside;                           /* cylinder, sphere: 1 particles inside, 0 outside */
    double aperture, wire;                /* screen [m] */
    int profile, circular;                /* screen */
    double half_x, half_y;                /* screen [m] */
    dem_vec amplitude, phase;             /* vibration: displacement A (sin(2 pi f t + phase) - sin(phase)) by component [m], [rad] */
    double frequency;                     /* [Hz] */
    dem_vec drift;                        /* constant velocity [m/s] */
    dem_vec spin_axis, spin_centre;       /* rotation about a line; force-controlled: axis of the motion */
    double spin, spin_rate;               /* now [rad/s], [rad/s2] */
    dem_vec belt;                         /* velocity of its surface within itself [m/s] */
    int slides;                           /* 1: its surface moves otherwise than its origin */
    int drive;                            /* dem_drive */
    double coordinate, rate, rate_change; /* controlled: way [m] or angle [rad] since it was put, and its derivatives */
    double inertia, load, damping;        /* controlled: [kg], [N], [N s/m] or [kg m2], [N m], [N m s/rad] */
    dem_motion_fn motion;                 /* prescribed */
    void *motion_user;
    double interval;                          /* prescribed: for its differences in time [s] */
    double motion_start;                      /* time at which the motion began; controlled: of the coordinate [s] */
    dem_vec position, velocity, acceleration; /* of its origin, now */
    double speed_bound, spin_bound;           /* its origin, apart from rotation, and its spin are not faster (until timers are set anew) */
    double acceleration_bound;                /* kinematic: nor does its origin accelerate more, apart from rotation [m/s2] */
    double side_bound;                        /* the same perpendicular to axis[2] */
    struct dem__tree *tree;                   /* mesh: the triangles, owned */
    dem_vec force, torque;                    /* exerted on the wall in this step [N], about its origin [N m]; means: by impulse */
    dem_vec impulse;                          /* time integral of the force [N s] */
} dem_wall;

/* What passed an exit. Owned by the world, in the order of passing. */
typedef struct dem_passed {
    double time;     /* [s] end of the step in which the centre crossed */
    double diameter; /* [m]; mass: density pi/6 diameter^3, of several materials told apart by group */
    dem_vec position, velocity;
    uint64_t id;
    int32_t group, exit; /* the number given to dem_add_spheres; wall index of the exit */
} dem_passed;

/* ---- laws ---- */

/* What a law sees of one contact. i is a sphere, j a sphere or a wall; n points from j to i. */
typedef struct dem_contact {
    double gap;              /* S = distance - r_i - r_j [m]; negative: overlap */
    double closing;          /* -dS/dt [m/s]; positive: approaching */
    double slip[3];          /* surface velocity of i against j, tangential [m/s] */
    double translation[3];   /* the part of it that the centres' velocities make [m/s] */
    double spin[3];          /* w_i - w_j [rad/s] */
    double normal[3];        /* n */
    double mass;             /* m_eff = m_i m_j/(m_i + m_j); wall: m_i [kg] */
    double dt;               /* time by which the history advances [s]; 0 when only the force is asked for */
    double rate;             /* 1 / time step of the world [1/s] */
    double share;            /* 1 / number of contacts of the busier partner [-] */
    const double *constants; /* as the law's prepare function left them */
    const void *user;        /* world->user */
} dem_contact;

/* What it answers: forces on i. A law fills normal, contact and ended, tangential (and what remains of it) with DEM_FRICTION, rolling
   with DEM_ROLLING, the rest with DEM_ENERGY; of a link normal, tangential and ended. */
typedef struct dem_response {
    double normal;        /* along n, positive repels [N] */
    double contact;       /* the part of it that the overlap makes; 0 where there is none [N] */
    double tangential[3]; /* perpendicular to n [N]; acts at the point that divides the distance as the radii do */
    double remaining[3];  /* the part of it that is there however small `contact`: lubrication, friction of what adheres [N]; default 0 */
    double rolling[3];    /* torque on i, the opposite on j [N m] */
    double elastic;       /* stored energy [J] */
    double normal_power;  /* dissipated by the normal dashpot [W] */
    double slide_loss;    /* dissipated by sliding in this step [J] */
    double rolling_power; /* dissipated by rolling and tangential dashpot [W] */
    double ended;         /* 1: the contact is over and its state may be dropped; else 0 (a double, to keep vectors of one kind) */
} dem_response;

/* Everything that a law may need when a contact is born. */
typedef struct dem_birth {
    const dem_def *def;
    int features; /* that the run was asked for */
    const dem_pair_def *pair;
    int material_i, material_j;
    double radius_i, radius_j; /* [m]; wall: radius_j = 0 and curvature below */
    double curvature;          /* of the wall at the point [1/m], 0 for a plane */
    double mass;               /* m_eff [kg] */
    double inertia;            /* I_i I_j/(I_i + I_j); wall: I_i [kg m2] */
    double damping_ratio;      /* of the pair's restitution and mode, DEM_LINEAR [-] */
    void *user;                /* world->user */
} dem_birth;

struct dem_world;

/* A law: a constant, so that the kernel made from it by DEM_KERNEL has no indirect call in its loop. */
typedef struct dem_law {
    const char *name;
    int version;   /* of the meaning of its state */
    int states;    /* doubles per contact, zero at birth, <= DEM_STATE_MAX */
    int history;   /* the first of them, which force may change; the rest change by dem_set_slot_state() only */
    int vectors;   /* the first 3 * vectors are tangential vectors, which the kernel turns with the contact */
    int constants; /* doubles that prepare fills, <= DEM_CONSTANTS_MAX */
    /* fills constants, and returns the k_n of a linear law with the pair's damping ratio [N/m], which makes its restitution accurate to
       the third order; else 0 */
    double (*prepare)(const dem_birth *birth, double *constants);
    void (*force)(const dem_contact *contact, double *state, dem_response *response); /* always inline, no calls, few branches */
    /* Both may be NULL. Called with world->user: born for the contacts that begin in a step, before their first force, sorted by partners;
       ended for one that is over. dem_get_contact() (of a link: dem_get_link()) and dem_set_slot_state() read and write them. */
    void (*born)(struct dem_world *world, const int32_t *slots, ptrdiff_t n, void *user);
    void (*ended)(struct dem_world *world, int32_t slot, void *user);
} dem_law;

/* To build upon: dem_prepare_linear and dem_force_linear, dem_force_linear_friction, dem_force_linear_rolling (states, history, vectors: 0,
   0, 0, with friction 3, 3, 1); the same of hertz (0, 0, 0; 4, 4, 1). Their constants are the first; yours follow (docs/dem.md). */
enum { DEM_LINEAR_CONSTANTS = 8, DEM_HERTZ_CONSTANTS = 8 };

/* ---- the world ---- */

/* Where the energy is and where it went [J]; sums from the first run with DEM_ENERGY on. */
typedef struct dem_energy_ledger {
    double kinetic, rotational, elastic, potential; /* now; potential against gravity, origin at 0 */
    double normal_loss, sliding_loss, rolling_loss; /* dissipated, computed from the laws */
    double wall_work, external_work;                /* done on the particles by moving walls and loads */
    double link_work;      /* done on them by links: less than 0 by what links have stored and dissipated, walls' work through them apart */
    double added, removed; /* carried in and out by particles */
    double start, start_potential, added_potential, removed_potential; /* when the ledger began; the potential parts */
    double released;                                                   /* potential energy given up so far, at least 0 */
    double error;                                                      /* what does not add up: the integration error */
} dem_energy_ledger;

typedef void (*dem_kernel_fn)(struct dem_world *world, ptrdiff_t first, ptrdiff_t end);

/* Private: what timers know of a particle. In a frame that falls since the list was built, t [s] ago, its surface is within off + t ball
   of x + t u: its velocity strays from u by less than ball until it is given another course. One cache line. */
typedef struct dem__course {
    double x, y, z, off;     /* [m] */
    double ux, uy, uz, ball; /* [m/s] */
} dem__course;

typedef double dem__six[6]; /* private: force [N] and torque [N m], or place [m] and spin [rad/s] */

/* Private: sums of forces and torques, and what makes accelerations of them. One cache line. */
typedef struct dem__sum {
    dem__six load;
    double per_mass, per_inertia; /* [1/kg], [1/(kg m2)] */
} dem__sum;

/* Private: what contacts of the same sizes and materials share. */
typedef struct dem__kind {
    double mass, predict; /* m_eff [kg]; factor of the closing speed in contact [-] */
    double sum, part;     /* r_i + r_j [m]; r_i / (r_i + r_j) [-], of a wall 1 */
    double constant[DEM_CONSTANTS_MAX];
} dem__kind;

/* Private: the contacts whose i are particles from `from` on, up to where the section before begins, in slots of their own: first ..
   first + live - 1. Without room (of the last: without end) new ones go into the last section. As i < j, a particle has contacts in its own
   section and later ones only. */
typedef struct dem__section {
    ptrdiff_t first, live, room;
    ptrdiff_t marked, deferred; /* contacts that begin or end in a step, listed in slots__; sums that wait for another thread */
    int32_t from, own; /* sums of particles from `own` on wait: see dem__claim */
    int32_t low, high; /* least and greatest number of a particle in deferred sums; for none INT32_MAX, 0 */
} dem__section;

/* Private: what a contact does, for the sums of its particles to which another thread adds first. */
typedef struct dem__deferral {
    double out[9];
    int32_t i, j;
} dem__deferral;

/* Private: what a contact that begins or ends leaves for the end of the step. */
typedef struct dem__handed {
    double n[3], shift; /* normal; how far apart it moves its bodies along it [kg m] */
    double impulse[9];  /* force on i, torques on i and j, over time [N s], [N m s] */
} dem__handed;

/* Private: what a section's contacts do to a wall. */
typedef struct dem__push {
    dem_vec force, torque;
} dem__push;

/* Private: two particles that may meet. */
typedef struct dem__near {
    int32_t i, j;    /* i < j */
    double distance; /* of centres, below which they are in contact [m] */
} dem__near;

/* Private: when near pairs, or particles and walls, are to be looked at. */
typedef struct dem__timers {
    int64_t from;                /* the step that others are counted from */
    int32_t *due;                /* step, or DEM__NEVER, or DEM__STOPPED */
    int32_t *earliest;           /* of each bunch: none of its timers is due before */
    int32_t *list;               /* those found due */
    ptrdiff_t sheaves, capacity; /* in use; room, in bunches */
    void *block;
    size_t bytes;
} dem__timers;
enum { DEM__NEVER = INT32_MAX - 1, DEM__STOPPED = INT32_MAX }; /* on the present course; as long as it touches, or has left */

/* A sphere: its state at its own origin step; between, x + v t + a t^2/2. dem_position() and its like evaluate. While forces are
   computed, v and spin are those in the middle of the step. Two cache lines, which are what contacts read. */
typedef struct dem_particle {
    dem_vec x;      /* [m] */
    double radius;  /* [m] */
    dem_vec v;      /* [m/s] */
    double mass;    /* [kg] */
    dem_vec a;      /* [m/s2] */
    int64_t origin; /* step of the state */
    dem_vec spin;   /* [rad/s] */
    double room__;  /* how much further it may stray from its course, at least [m/s] */
} dem_particle;

/* Spheres, walls and contacts at one time. Owned by the caller, filled by dem_init. Fields are for reading unless a function says
   otherwise; arrays have `count` entries and stay valid until the next call that adds, removes or runs. */
typedef struct dem_world {
    dem_def def;
    void *user;      /* yours: handed to the law's hooks; not saved */
    int64_t step;    /* steps done */
    double time;     /* [s] */
    ptrdiff_t count; /* particles present; a dropped one stays, with alive = 0, until a list is built for which it pays to close the gap */
    dem_status status; /* first failure of a run; then particle and step of it */
    uint64_t failed_id;
    int walls;
    dem_wall wall[DEM_WALLS_MAX];
    ptrdiff_t passed_count;
    dem_passed *passed;
    int64_t particle_steps; /* sum over steps of particles present */
    int64_t contact_steps;  /* sum over steps of live contacts */
    int64_t looks;          /* pairs and walls looked at */
    int64_t rebuilds;       /* of the neighbour list */

    dem_particle *particle;
    dem_vec *spin_rate;                           /* [rad/s2] */
    uint64_t *id;                                 /* stable, in the order of adding, from 0 */
    int32_t *material, *group, *alive, *touching; /* touching: live contacts */

    /* the rest is private */
    double dt__, kernel_dt__, start_time__, target__, pace__, stretch__, margin__, slack__, reach__, fall__, list_fall__, blur__;
    dem_vec list_velocity__, list_acceleration__; /* of the frame in which the list waits for somebody to move */
    int64_t start_step__, next_check__;
    double damping_ratio__[DEM_MATERIALS_MAX][DEM_MATERIALS_MAX];
    int keeps_out__, fresh__, stale__, meshes__, places__, controls__, leaving__, loads_on__, states__, constants__, has_periodic__,
        features__, ledger_on__, ledger_started__;
    uint64_t next_id__;
    const dem_law *law__;
    dem_energy_ledger ledger__;
    ptrdiff_t capacity__, passed_capacity__, dropped__, active_count__, unsettled_count__;
    void *particle_block__, *live_block__;
    size_t particle_bytes__, live_bytes__;
    dem__sum *sum__;
    dem__six *load__;     /* what does not change in a step */
    dem__six *external__; /* the external part of it; the rest is of links */
    dem__six *linked__;   /* place and spin when links were evaluated last */
    dem_vec *listed_at__; /* position when the list was built */
    dem_vec *impact__;    /* what a contact that has just begun adds to its velocity by the middle of the impact [m/s] */
    dem__course *course__;
    double *shifted__;    /* how far first and last steps of contacts have shifted it from its course [m] */
    double *wall_speed__; /* speed that the timers of walls count on */
    double *share__;      /* of its mass that a contact may count on: 1 / contacts [-] */
    int32_t *active__, *is_active__, *wall_head__, *adjacent_start__, *cell_next__, *remap__, *link_head__, *link_loaded__,
        *unsettled__; /* link_loaded: its load has a part of links; unsettled: list of those with is_active 2 */

    /* near pairs p, 0 .. near_count - 1; particles and walls i * walls + k */
    ptrdiff_t near_count__, due__, adjacent_capacity__, cells_capacity__; /* due: pairs looked at in the last step */
    int32_t *adjacent__, *cells__;                                        /* adjacent: (pair, other particle) of each particle */
    dem__timers pair_timers__, wall_timers__;
    dem__near *near__;
    uint32_t *wall_sure__; /* step, modulo 2^32, before which a wall need not be looked at, whatever the particle's course */
    int64_t listed__;      /* step at which the list was built */

    /* live contacts, in slots: in each section those of a step by partners, after those of earlier steps; gaps are filled from its end;
       now and then all are ordered by i, the last first. What has happened alone fixes their order, and that the order of every sum */
    ptrdiff_t live_count__, live_capacity__, born__;
    int sections__;
    dem__section section__[DEM__SECTIONS];
    dem__push push__[DEM__SECTIONS][DEM_WALLS_MAX];
    dem__deferral *deferral__; /* with threads */
    int32_t *live_i__, *live_j__, *live_element__, *live_near__, *live_wall_next__, *live_kind__,
        *slots__; /* kind: or -1, has its own; slots: a list, for the moment, or one in each section */
    uint8_t *live_event__, *live_ended__;
    double *live_gap__, *live_force__;
    dem__kind kind__[DEM_KINDS_MAX];
    int kinds__;
    double *live_mass__, *live_predict__, *live_sum__, *live_part__, *live_constant__[DEM_CONSTANTS_MAX]; /* of those that have their own */
    double *live_place__[4]; /* with a mesh: normal and gap of the place that the contact follows; with a cone: its curvature */
    double *live_state__[DEM_STATE_MAX];
    double *live_out__[9]; /* force on i, torques on i and j: of a run's last step */
    dem__handed *live_handed__;
    double *live_elastic__, *live_power__[3], *live_loss__[4]; /* with a ledger: normal, rolling, wall; normal, sliding, rolling, wall */

    /* links, in the order of their making; each stands in the lists of its bodies */
    const dem_law *link_law__;
    dem_kernel_fn link_kernel__;
    double link_interval__, link_near__;
    int links_on__, link_stride__, link_states__;
    ptrdiff_t link_count__, link_capacity__;
    void *link_block__;
    size_t link_bytes__;
    int32_t *link_i__, *link_j__, *link_element__, *link_next_i__, *link_next_j__;
    double *link_state__[DEM_STATE_MAX], *link_out__[9], *link_gap__;
    uint8_t *link_ended__;
} dem_world;

/* ------------------------------------------------------------------------------------------ >>declarations */

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
/* The parameters of a pair of materials, in either order, to be edited; NULL if an index is out of range. */
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
/* Sets velocity [m/s] and spin [rad/s] of particle i (array index). */
DEM_API dem_status dem_set_motion(dem_world *world, ptrdiff_t i, dem_vec velocity, dem_vec spin);
/* Sets a constant external force [N] and torque [N m] on particle i, until changed. */
DEM_API dem_status dem_set_load(dem_world *world, ptrdiff_t i, dem_vec force, dem_vec torque);
/* Takes particle i out. */
DEM_API dem_status dem_remove(dem_world *world, ptrdiff_t i);

/* ---- filling, feeding, removing ---- */

#define DEM_SIZES_MAX 32 /* sizes of a list: a sieve stack has fewer */

/* A part of space, for filling, removing and measuring. Made by the three functions below; functions that take one return
   DEM_BAD_ARGUMENT (or NaN) if it is not finite or a length is negative. */
typedef enum dem_region_kind { DEM_REGION_BOX, DEM_REGION_CYLINDER, DEM_REGION_SPHERE } dem_region_kind;
typedef struct dem_region {
    dem_region_kind kind;
    dem_vec low, high;     /* box: its corners; cylinder: centre of its bottom; sphere: its centre [m] */
    dem_vec axis;          /* cylinder: from bottom to top, of any length but 0 */
    double length, radius; /* cylinder, sphere [m] >= 0 */
} dem_region;
DEM_API dem_region dem_box_region(dem_vec low, dem_vec high);                                       /* low = high along an axis: a face */
DEM_API dem_region dem_cylinder_region(dem_vec bottom, dem_vec axis, double length, double radius); /* length 0: a disc */
DEM_API dem_region dem_sphere_region(dem_vec centre, double radius);
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
    double smallest, largest; /* where all but the list are cut off [m] > 0, largest <= 1e6 smallest */
} dem_sizes;
DEM_API dem_sizes dem_one_size(double diameter);
DEM_API dem_sizes dem_size_list(int n, const double *diameter, const double *share,
                                int by_mass); /* more than DEM_SIZES_MAX: refused later */
DEM_API dem_sizes dem_uniform_sizes(double smallest, double largest, int by_mass);
DEM_API dem_sizes dem_lognormal_sizes(double median, double spread, double smallest, double largest, int by_mass);
/* Rosin & Rammler 1933: share coarser than d is exp(-(d/scale)^exponent). */
DEM_API dem_sizes dem_rosin_rammler_sizes(double scale, double exponent, double smallest, double largest, int by_mass);
/* One diameter [m]; *random is the generator's state, any number to begin with. NaN if the sizes are out of range. */
DEM_API double dem_draw_size(const dem_sizes *sizes, uint64_t *random);

/* A source of spheres: where, what, and how far it is. Owned by the caller, plain data: a copy of it beside the saved world makes a
   restart go on with the same spheres. (It is no part of the world because a world may have any number, and most have none.) */
typedef struct dem_feed {
    dem_region region; /* spheres lie wholly within; in a face or disc their centres do */
    dem_sizes sizes;
    int material, group; /* as in dem_add_spheres; default 0 */
    dem_vec velocity;    /* of the new spheres [m/s]; default 0 */
    dem_vec scatter;     /* largest deviation from it, uniform by component [m/s] >= 0; default 0 */
    int tries;           /* random places tried for a sphere before it is given up, 1 .. 1000000; default 1000 */
    uint64_t random;     /* the generator's state: the seed at first; default 1 */
    /* written by the functions below */
    ptrdiff_t placed, missed;        /* spheres in all; those that dem_fill found no place for */
    double placed_mass, missed_mass; /* [kg] */
    double due, due_mass;            /* what dem_feed_number, dem_feed_mass still owe [-], [kg] */
    double waiting;                  /* diameter of the sphere that is next, 0: none drawn yet [m] */
} dem_feed;
DEM_API dem_feed dem_default_feed(void); /* one size of 1 mm in a cube of 0.1 m at the origin: to be edited */

/* Places so many spheres, or the number whose mass comes nearest to `mass` [kg], at random places where they touch neither spheres nor
   enabled walls, the largest first. Spheres that find no place are dropped and counted in missed; random places fill up to about 0.3 of
   a volume within reasonable time. Statuses: DEM_BAD_ARGUMENT, DEM_OUT_OF_MEMORY, DEM_TOO_MANY; then nothing has changed. */
DEM_API dem_status dem_fill(dem_world *world, dem_feed *feed, ptrdiff_t count);
DEM_API dem_status dem_fill_mass(dem_world *world, dem_feed *feed, double mass);
/* Places what falls due within duration [s] >= 0 at a rate [1/s] or [kg/s] >= 0; call it before every dem_run of that duration, no longer
   than spheres need to clear the region. One that finds no place waits, and with it those behind it, so that sizes keep their shares: due
   tells how far the source is behind. */
DEM_API dem_status dem_feed_number(dem_world *world, dem_feed *feed, double rate, double duration);
DEM_API dem_status dem_feed_mass(dem_world *world, dem_feed *feed, double mass_flow, double duration);
/* Takes out the spheres whose centres lie in the region; returns how many, or minus a dem_status. */
DEM_API ptrdiff_t dem_remove_region(dem_world *world, const dem_region *region);

/* Walls. Each returns the wall's index (>= 0), or minus a dem_status. normal and axis need not have length 1, but not 0. */
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

/* Reads an STL file from memory (3D Systems 1988), binary or ASCII, whatever its first word says. bytes: [size]; scale [m per unit of the
   file] > 0, 1e-3 for millimetres; weld [m] >= 0: corners nearer than this become one, 0 joins equal ones only; allocator may be NULL;
   report may be NULL. DEM_OK also for a file with faults, which the report counts; DEM_BAD_DATA if no triangle is left;
   DEM_OUT_OF_MEMORY. On failure *mesh is empty. */
DEM_API dem_status dem_read_stl(const void *bytes, size_t size, double scale, double weld, const dem_allocator *allocator, dem_mesh *mesh,
                                dem_stl_report *report);
DEM_API void dem_free_mesh(dem_mesh *mesh); /* frees what dem_read_stl made; safe on a zeroed or freed one */

/* ---- running ---- */

/* Advances by duration [s] (to the nearest step; remainders carry over to the next call). features: DEM_LINEAR | DEM_FRICTION | ...
   Statuses: DEM_BAD_ARGUMENT (features that no shipped law has), DEM_OUT_OF_MEMORY, DEM_NOT_FINITE and DEM_TOO_FAST
   (world->failed_id names the particle, world->step the step; the world can be read, saved and freed). */
DEM_API dem_status dem_run(dem_world *world, double duration, int features);
/* The same with a law of your own and the kernel that DEM_KERNEL made from it. features: those that DEM_KERNEL was given; without
   DEM_FRICTION or DEM_ROLLING of them the shipped prepare functions leave these out. Others, or another law's kernel: DEM_BAD_ARGUMENT. */
DEM_API dem_status dem_run_law(dem_world *world, double duration, const dem_law *law, dem_kernel_fn kernel, int features);

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

/* The law of links and the kernel that DEM_LINK_KERNEL made from it; before the first link, and again after dem_load. Of a dem_law, a
   link uses states, history, vectors, force (gap of any sign; contact, constants and mass are not there) and ended.
   interval: time between evaluations [s] > 0, rounded down to steps, at least one; the force is constant between.
   near: gap below which linked bodies are in contact for the law of contacts too [m] >= 0, at most 0.01 * skin * smallest diameter;
   what grows fast near contact (lubrication) belongs there. DEM_LAW_MISMATCH if there are links with another number of states. */
DEM_API dem_status dem_set_links(dem_world *world, const dem_law *law, dem_kernel_fn kernel, double interval, double near);
/* Links particle i with j (particle, or -1 - wall at an element of it). state: [law->states]. From a law's born hook, or between runs.
   Links follow a particle's leaving: ended is called, and the link is gone. */
DEM_API dem_status dem_add_link(dem_world *world, ptrdiff_t i, ptrdiff_t j, int32_t element, const double *state);
DEM_API ptrdiff_t dem_link_count(const dem_world *world);

/* ---- reading ---- */

DEM_API dem_vec dem_position(const dem_world *world, ptrdiff_t i); /* now [m]; NaN if i is out of range */
DEM_API dem_vec dem_velocity(const dem_world *world, ptrdiff_t i); /* now [m/s] */
DEM_API dem_vec dem_momentum(const dem_world *world);              /* of all particles [kg m/s] */
/* Energy now. Sums of work and losses are kept by runs with DEM_ENERGY only. */
DEM_API dem_energy_ledger dem_energy(const dem_world *world);

typedef struct dem_contact_info {
    ptrdiff_t i, j;              /* particles; j < 0: wall -1 - j */
    double gap;                  /* [m] */
    dem_vec force;               /* on i [N] */
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
DEM_API void dem_set_slot_state(dem_world *world, int32_t slot, const double *state); /* for hooks of laws */

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
                                    cylinder; what overlaps counts twice */
    double coordination;         /* contacts of a sphere, mean of those in it [-] */
    dem_vec velocity;            /* mean by mass [m/s] */
    double granular_temperature; /* sum m |v - velocity|^2/(3 sum m) [m2/s2] */
    double contact_stress[3][3]; /* sum F l/V over contacts and links, l the part of the branch in the region [Pa]; the branch goes from
                                    centre to centre, from a wall's point to the centre (Goldhirsch 2010, the region as kernel) */
    double kinetic_stress[3][3]; /* sum m v' v'/V, v' = v - velocity [Pa] */
} dem_measure;
/* Along periodic axes a region is no longer than the box. A region without volume has NaN where it would be divided by. */
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

/* >>portable-math: exp, log, sin and their kin with the same bits on every machine; libm's differ. Word for word the same in every
   Riddle header that needs it (tests/portable_math.h is the master, tests/check_headers compares the copies). Within 5 ulp unless
   stated; NaN outside the domain. */
/* clang-format off */
#ifndef RIDDLE_PORTABLE_MATH
#define RIDDLE_PORTABLE_MATH
#define RIDDLE_PI 3.14159265358979323846
#define RIDDLE_LN2_HI 0.6931471803691238   /* first 32 bits of ln 2, so that k * LN2_HI is exact for |k| < 2^20 */
#define RIDDLE_LN2_LO 1.9082149292705877e-10

/* exp(r) - 1 for |r| < 0.36, Taylor series to r^14 */
static inline double riddle__expm1_small(double r) {
    double p = 1.0 / 87178291200.0;
    p = p * r + 1.0 / 6227020800.0;
    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    return r + r * r * p;
}

static inline double riddle_exp(double x) {
    if (!(x > -745.2)) return x != x ? x : 0.0;
    if (x > 709.79) return HUGE_VAL;
    double k = floor(x * 1.4426950408889634 + 0.5);
    double r = (x - k * RIDDLE_LN2_HI) - k * RIDDLE_LN2_LO;
    return ldexp(1.0 + riddle__expm1_small(r), (int)k);
}

static inline double riddle_expm1(double x) { return fabs(x) < 0.35 ? riddle__expm1_small(x) : riddle_exp(x) - 1.0; }

/* log(1 + f) for -0.3 <= f <= 0.42: 2 atanh(s) with s = f / (2 + f) */
static inline double riddle__log1p_small(double f) {
    double s = f / (2.0 + f), z = s * s, p = 2.0 / 23.0;
    p = p * z + 2.0 / 21.0;
    p = p * z + 2.0 / 19.0;
    p = p * z + 2.0 / 17.0;
    p = p * z + 2.0 / 15.0;
    p = p * z + 2.0 / 13.0;
    p = p * z + 2.0 / 11.0;
    p = p * z + 2.0 / 9.0;
    p = p * z + 2.0 / 7.0;
    p = p * z + 2.0 / 5.0;
    p = p * z + 2.0 / 3.0;
    return f - s * (f - z * p);
}

static inline double riddle_log(double x) {
    if (!(x > 0.0)) return x == 0.0 ? -HUGE_VAL : (double)NAN;
    if (x > 1.7976931348623157e308) return x;
    int e;
    double m = frexp(x, &e);
    if (m < 0.70710678118654752) {
        m *= 2.0;
        e -= 1;
    }
    return e * RIDDLE_LN2_HI + (riddle__log1p_small(m - 1.0) + e * RIDDLE_LN2_LO);
}

static inline double riddle_log1p(double x) { return x > -0.29 && x < 0.4 ? riddle__log1p_small(x) : riddle_log(1.0 + x); }

/* x^y for x >= 0; relative error about (2 + |y log x|) ulp */
static inline double riddle_pow(double x, double y) {
    if (y == 0.0 || x == 1.0) return 1.0;
    return riddle_exp(y * riddle_log(x));
}

static inline double riddle_cbrt(double x) {
    if (x == 0.0 || !(fabs(x) <= 1.7976931348623157e308)) return x;
    int e;
    double m = frexp(fabs(x), &e); /* in [0.5, 1) */
    int third = (e + 3000) / 3 - 1000, rest = e - 3 * third;
    m = ldexp(m, rest); /* in [0.5, 4) */
    double y = 0.65 + 0.25 * m;
    for (int i = 0; i < 5; i++) y -= (y * y * y - m) / (3.0 * y * y);
    return ldexp(x < 0.0 ? -y : y, third);
}

/* sin and cos of r + quarter turns, |r| <= pi/4 */
static inline double riddle__sin_quarter(double r, int quarter) {
    double z = r * r, p, value;
    if (quarter & 1) {
        p = -1.0 / 6402373705728000.0;
        p = p * z + 1.0 / 20922789888000.0;
        p = p * z - 1.0 / 87178291200.0;
        p = p * z + 1.0 / 479001600.0;
        p = p * z - 1.0 / 3628800.0;
        p = p * z + 1.0 / 40320.0;
        p = p * z - 1.0 / 720.0;
        p = p * z + 1.0 / 24.0;
        value = 1.0 - (0.5 * z - z * z * p);
    } else {
        p = 1.0 / 355687428096000.0;
        p = p * z - 1.0 / 1307674368000.0;
        p = p * z + 1.0 / 6227020800.0;
        p = p * z - 1.0 / 39916800.0;
        p = p * z + 1.0 / 362880.0;
        p = p * z - 1.0 / 5040.0;
        p = p * z + 1.0 / 120.0;
        p = p * z - 1.0 / 6.0;
        value = r + r * z * p;
    }
    return quarter & 2 ? -value : value;
}

static inline double riddle__sin_shifted(double x, int quarters) {
    if (!(fabs(x) <= 1e6)) return (double)NAN;
    double n = floor(x * 0.63661977236758134 + 0.5);
    double r = ((x - n * 1.5707963267341256) - n * 6.077100506303966e-11) - n * 2.0222662487959506e-21;
    return riddle__sin_quarter(r, (int)(n - 4.0 * floor(n * 0.25)) + quarters);
}

/* |x| <= 1e6 rad, NaN beyond; absolute error 2e-16 */
static inline double riddle_sin(double x) { return riddle__sin_shifted(x, 0); }
static inline double riddle_cos(double x) { return riddle__sin_shifted(x, 1); }

static inline double riddle_atan(double x) {
    double t = fabs(x), base = 0.0, sign = 1.0;
    if (t > 1.0) {
        t = 1.0 / t;
        base = 0.5 * RIDDLE_PI;
        sign = -1.0;
    }
    if (t > 0.26794919243112270) {
        base += sign * (RIDDLE_PI / 6.0);
        t = (1.7320508075688773 * t - 1.0) / (t + 1.7320508075688773);
    }
    double z = t * t, p = 0.0;
    for (int k = 15; k > 0; k--) p = z * (1.0 / (2 * k + 1) - p);
    double value = base + sign * (t - t * p);
    return x < 0.0 ? -value : value;
}

static inline double riddle_atan2(double y, double x) {
    if (x == 0.0 && y == 0.0) return 0.0;
    if (x != x || y != y) return (double)NAN;
    if (fabs(y) > fabs(x)) return (y > 0.0 ? 0.5 : -0.5) * RIDDLE_PI - riddle_atan(x / y);
    return riddle_atan(y / x) + (x < 0.0 ? (y < 0.0 ? -RIDDLE_PI : RIDDLE_PI) : 0.0);
}

static inline double riddle_acos(double x) {
    return fabs(x) <= 1.0 ? riddle_atan2(sqrt((1.0 - x) * (1.0 + x)), x) : (double)NAN;
}

static inline double riddle_asin(double x) {
    return fabs(x) <= 1.0 ? riddle_atan2(x, sqrt((1.0 - x) * (1.0 + x))) : (double)NAN;
}
#endif /* RIDDLE_PORTABLE_MATH */
/* clang-format on */
/* <<portable-math */

/* ------------------------------------------------------------------------------------------------- >>laws */

/* Linear spring-dashpot (Elskamp & Kruggel-Emden 2019, eqs 4 and 5). Constants: */
enum {
    DEM__K,       /* k_n [N/m] */
    DEM__GAMMA,   /* dashpot [kg/s] */
    DEM__FLOOR,   /* 0 clipped, -inf naive [N] */
    DEM__KT,      /* k_t [N/m] */
    DEM__MU,      /* Coulomb coefficient [-] */
    DEM__GAMMA_T, /* tangential dashpot [kg/s] */
    DEM__ROLL,    /* lever arm [m] */
    DEM__ROLL_CAP /* I_red/2 [kg m2]: more would reverse the spin within a step */
};
/* State: DEM__XI.. tangential displacement [m], rotated with the contact by the kernel. */
enum { DEM__XI };

/* By what the dashpot's velocity, predicted over a step h, is multiplied: so that two bodies alone, on a linear spring of k m/h^2
   and a dashpot of c m/h, lose in a swing what they should, to the third order. From the roots of what the scheme makes of them,
   2 z (z - 1)^2 + 2 k z^2 + c (z - 1)(3 z - 1) = 0 for positions that go with z^n. */
DEM_INLINE double dem__prediction(double k, double c) { return 1.0 - (11.0 * k - 5.0 * c * c + 9.0 * c * k - 3.0 * c * c * c) / 24.0; }

/* Resistance to rolling, relative and capped: at most the torque that stops the relative spin in two steps. */
DEM_INLINE void dem__roll(const dem_contact *c, double normal, double arm, double cap, dem_response *r) {
    const double *n = c->normal, *w = c->spin;
    double along = w[0] * n[0] + w[1] * n[1] + w[2] * n[2];
    double x = w[0] - along * n[0], y = w[1] - along * n[1], z = w[2] - along * n[2];
    double speed = sqrt(x * x + y * y + z * z) + 1e-300;
    double torque = arm * normal / speed, most = cap * c->share * c->rate;
    torque = torque < most ? torque : most;
    r->rolling[0] = -torque * x;
    r->rolling[1] = -torque * y;
    r->rolling[2] = -torque * z;
    r->rolling_power += torque * speed * speed;
}

DEM_INLINE void dem__linear(const dem_contact *c, double *state, dem_response *r, int features) {
    const double *p = c->constants;
    double spring = -p[DEM__K] * c->gap, force = spring + p[DEM__GAMMA] * c->closing;
    force = force > p[DEM__FLOOR] ? force : p[DEM__FLOOR];
    force = c->gap < 0.0 ? force : 0.0;
    r->normal = r->contact = force;
    r->ended = c->gap < 0.0 ? 0.0 : 1.0;
    r->elastic = c->gap < 0.0 ? 0.5 * spring * -c->gap : 0.0;
    r->normal_power = c->gap < 0.0 ? (force - spring) * c->closing : 0.0;
    r->slide_loss = 0.0;
    r->rolling_power = 0.0;
    if (!(features & DEM_FRICTION)) return;

    double push = force > 0.0 ? force : 0.0, limit = p[DEM__MU] * push;
    double relax = p[DEM__GAMMA_T] / (p[DEM__KT] > 0.0 ? p[DEM__KT] : 1.0), xi[3], t[3]; /* [s]; without a spring any */
    for (int a = 0; a < 3; a++) {
        xi[a] = state[DEM__XI + a] + c->slip[a] * c->dt;
        t[a] = p[DEM__KT] * xi[a] + p[DEM__GAMMA_T] * c->slip[a];
    }
    double size = sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]), scale = limit / (size + 1e-300);
    scale = size > limit ? scale : 1.0;
    for (int a = 0; a < 3; a++) {
        double kept = size > limit ? scale * (xi[a] + relax * c->slip[a]) : xi[a];        /* sliding, the spring holds the whole force */
        r->slide_loss += 0.5 * p[DEM__KT] * (state[DEM__XI + a] + kept) * (xi[a] - kept); /* work of the mean force on the way slid */
        r->elastic += 0.5 * p[DEM__KT] * kept * kept;
        r->rolling_power += (scale * t[a] - p[DEM__KT] * kept) * c->slip[a];
        state[DEM__XI + a] = kept;
        r->tangential[a] = -scale * t[a];
    }
    if (features & DEM_ROLLING) dem__roll(c, push, p[DEM__ROLL], p[DEM__ROLL_CAP], r);
}

static inline double dem_prepare_linear(const dem_birth *b, double *constants) {
    const dem_pair_def *pair = b->pair;
    double k = pair->stiffness;
    double gamma = 2.0 * b->damping_ratio * sqrt(k * b->mass);
    constants[DEM__K] = k;
    constants[DEM__GAMMA] = gamma;
    constants[DEM__FLOOR] = pair->mode == DEM_CLIPPED ? 0.0 : -HUGE_VAL;
    constants[DEM__KT] = k * pair->tangential_ratio;
    constants[DEM__MU] = b->features & DEM_FRICTION ? pair->friction : 0.0;
    constants[DEM__GAMMA_T] = gamma * pair->tangential_damping;
    constants[DEM__ROLL] = b->features & DEM_ROLLING ? pair->rolling : 0.0;
    constants[DEM__ROLL_CAP] = 0.5 * b->inertia;
    return k;
}

/* Hertz-Mindlin: normal force 4/3 E* sqrt(R*) delta^1.5, dashpot sqrt(5) beta sqrt(m k) delta^0.25 (Tsuji et al. 1992; gives e
   exactly: Antypov & Elliott 2011), tangential force 8 G* sqrt(R* delta) times the displacement (Mindlin 1949, without microslip), so
   that a stored force follows the contact radius both ways: the form that Chung & Ooi's impact tests and the bulk codes use. What
   the change of radius gives or takes stands in the sliding loss, with its sign. */
enum {
    DEM__HERTZ_K,
    DEM__HERTZ_GAMMA,
    DEM__HERTZ_RADIUS,
    DEM__HERTZ_G,
    DEM__HERTZ_MU,
    DEM__HERTZ_GAMMA_T,
    DEM__HERTZ_ROLL,
    DEM__HERTZ_CAP
};
enum { DEM__FT, DEM__AREA = 3 }; /* tangential force [N], contact radius [m] */

DEM_INLINE void dem__hertz(const dem_contact *c, double *state, dem_response *r, int features) {
    const double *p = c->constants;
    double overlap = c->gap < 0.0 ? -c->gap : 0.0, area = sqrt(p[DEM__HERTZ_RADIUS] * overlap);
    double spring = p[DEM__HERTZ_K] * area * overlap, damping = p[DEM__HERTZ_GAMMA] * sqrt(area);
    double step = c->dt / c->mass, k = 1.5 * p[DEM__HERTZ_K] * area * c->dt * step; /* of the spring as stiff as it is now */
    double closing = dem__prediction(k, damping * step) * c->closing, force = spring + damping * closing;
    r->normal = r->contact = force;
    r->ended = c->gap < 0.0 ? 0.0 : 1.0;
    r->elastic = 0.4 * spring * overlap;
    r->normal_power = (1.0 - k / 24.0) * damping * closing * c->closing; /* see the kernel */
    r->slide_loss = 0.0;
    r->rolling_power = 0.0;
    if (!(features & DEM_FRICTION)) return;

    double push = force > 0.0 ? force : 0.0, limit = p[DEM__HERTZ_MU] * push;
    double kt = p[DEM__HERTZ_G] * area, before = state[DEM__AREA];
    double follow = area / (before + 1e-300); /* at birth the force is zero */
    double t[3], f[3], old = 0.0, work = 0.0, now = 0.0;
    for (int a = 0; a < 3; a++) {
        old += state[DEM__FT + a] * state[DEM__FT + a];
        f[a] = follow * state[DEM__FT + a] + kt * c->slip[a] * c->dt;
        t[a] = f[a] + damping * p[DEM__HERTZ_GAMMA_T] * c->slip[a];
    }
    double size = sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2]), scale = limit / (size + 1e-300);
    scale = size > limit ? scale : 1.0;
    for (int a = 0; a < 3; a++) {
        double kept = size > limit ? scale * t[a] : f[a];
        work += 0.5 * (state[DEM__FT + a] + kept) * c->slip[a] * c->dt;
        now += kept * kept;
        r->rolling_power += (scale * t[a] - kept) * c->slip[a];
        state[DEM__FT + a] = kept;
        r->tangential[a] = -scale * t[a];
    }
    double stored = 0.5 * now / (kt + 1e-300);
    r->slide_loss = 0.5 * old / (p[DEM__HERTZ_G] * before + 1e-300) + work - stored;
    r->elastic += stored;
    state[DEM__AREA] = area;
    if (features & DEM_ROLLING) dem__roll(c, push, p[DEM__HERTZ_ROLL], p[DEM__HERTZ_CAP], r);
}

/* shear modulus of the pair: 1/G* = (2 - nu_i)/G_i + (2 - nu_j)/G_j with G = E/(2 (1 + nu)) */
static inline double dem_prepare_hertz(const dem_birth *b, double *constants) {
    const dem_material *i = &b->def->material[b->material_i], *j = &b->def->material[b->material_j];
    double modulus = 1.0 / ((1.0 - i->poisson_ratio * i->poisson_ratio) / i->young_modulus +
                            (1.0 - j->poisson_ratio * j->poisson_ratio) / j->young_modulus);
    double shear = 0.5 / ((2.0 - i->poisson_ratio) * (1.0 + i->poisson_ratio) / i->young_modulus +
                          (2.0 - j->poisson_ratio) * (1.0 + j->poisson_ratio) / j->young_modulus);
    double inverse = 1.0 / b->radius_i + (b->radius_j > 0.0 ? 1.0 / b->radius_j : b->curvature);
    double log_e = riddle_log(b->pair->restitution), beta = -log_e / sqrt(log_e * log_e + RIDDLE_PI * RIDDLE_PI);
    constants[DEM__HERTZ_K] = 4.0 / 3.0 * modulus;
    constants[DEM__HERTZ_GAMMA] = sqrt(5.0) * beta * sqrt(4.0 / 3.0 * modulus * b->mass);
    constants[DEM__HERTZ_RADIUS] = 1.0 / inverse;
    constants[DEM__HERTZ_G] = 8.0 * shear;
    constants[DEM__HERTZ_MU] = b->features & DEM_FRICTION ? b->pair->friction : 0.0;
    constants[DEM__HERTZ_GAMMA_T] = b->pair->tangential_damping;
    constants[DEM__HERTZ_ROLL] = b->features & DEM_ROLLING ? b->pair->rolling : 0.0;
    constants[DEM__HERTZ_CAP] = 0.5 * b->inertia;
    return 0.0;
}

#define DEM__FORCE(name, body, features)                                                                                                   \
    DEM_INLINE void name(const dem_contact *c, double *state, dem_response *r) { body(c, state, r, features); }
DEM__FORCE(dem_force_linear, dem__linear, DEM_LINEAR)
DEM__FORCE(dem_force_linear_friction, dem__linear, DEM_FRICTION)
DEM__FORCE(dem_force_linear_rolling, dem__linear, DEM_FRICTION | DEM_ROLLING)
DEM__FORCE(dem_force_hertz, dem__hertz, DEM_HERTZ)
DEM__FORCE(dem_force_hertz_friction, dem__hertz, DEM_FRICTION)
DEM__FORCE(dem_force_hertz_rolling, dem__hertz, DEM_FRICTION | DEM_ROLLING)

/* ---------------------------------------------------------------------------------------------- >>geometry */

DEM_INLINE dem_vec dem__add(dem_vec a, dem_vec b) { return dem_vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
DEM_INLINE dem_vec dem__sub(dem_vec a, dem_vec b) { return dem_vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
DEM_INLINE dem_vec dem__scale(double s, dem_vec a) { return dem_vec3(s * a.x, s * a.y, s * a.z); }
DEM_INLINE dem_vec dem__plus(dem_vec a, double s, dem_vec b) { return dem_vec3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z); }
DEM_INLINE double dem__dot(dem_vec a, dem_vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
DEM_INLINE dem_vec dem__cross(dem_vec a, dem_vec b) {
    return dem_vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
DEM_INLINE double dem__length(dem_vec a) { return sqrt(dem__dot(a, a)); }

/* Rotation of v by an angle [rad] about a unit axis (Rodrigues). */
static inline dem_vec dem__rotated(dem_vec v, dem_vec axis, double angle) {
    double turns = angle / (2.0 * RIDDLE_PI), phase = 2.0 * RIDDLE_PI * (turns - floor(turns));
    double s = riddle_sin(phase), c = riddle_cos(phase);
    return dem__add(dem__add(dem__scale(c, v), dem__scale(s, dem__cross(axis, v))), dem__scale((1.0 - c) * dem__dot(axis, v), axis));
}

DEM_INLINE double dem__vibration(double amplitude, double phase, double turns, double rate, double *velocity, double *acceleration) {
    if (amplitude == 0.0) {
        *velocity = *acceleration = 0.0;
        return 0.0;
    }
    double angle = 2.0 * RIDDLE_PI * (turns - floor(turns)) + phase, s = riddle_sin(angle);
    *velocity = amplitude * rate * riddle_cos(angle);
    *acceleration = -amplitude * rate * rate * s;
    return amplitude * (phase == 0.0 ? s : s - riddle_sin(phase));
}

/* What vibration does to a wall. */
typedef struct dem__sway {
    dem_vec shift, velocity, acceleration;
} dem__sway;
static inline dem__sway dem__sway_at(const dem_wall *w, double t) {
    const double rate = 2.0 * RIDDLE_PI * w->frequency, turns = w->frequency * t;
    dem__sway s;
    s.shift.x = dem__vibration(w->amplitude.x, w->phase.x, turns, rate, &s.velocity.x, &s.acceleration.x);
    s.shift.y = dem__vibration(w->amplitude.y, w->phase.y, turns, rate, &s.velocity.y, &s.acceleration.y);
    s.shift.z = dem__vibration(w->amplitude.z, w->phase.z, turns, rate, &s.velocity.z, &s.acceleration.z);
    return s;
}

/* Do two walls vibrate as one, as a deck and its side wall do? */
DEM_INLINE int dem__sways_with(const dem_wall *a, const dem_wall *b) {
    return memcmp(&a->amplitude, &b->amplitude, sizeof a->amplitude) == 0 && memcmp(&a->phase, &b->phase, sizeof a->phase) == 0 &&
           a->frequency == b->frequency && a->motion_start == b->motion_start;
}

/* The frame and place that a pose gives a wall. */
static inline dem_vec dem__posed(const dem_wall *w, const dem_pose *pose, dem_vec *axis) {
    const double angle = dem__length(pose->turn);
    dem_vec arm = dem__sub(w->origin, w->spin_centre);
    for (int k = 0; k < 3; k++) axis[k] = w->rest_axis[k];
    if (angle != 0.0) { /* NaN goes on */
        const dem_vec about = dem__scale(1.0 / angle, pose->turn);
        for (int k = 0; k < 3; k++) axis[k] = dem__rotated(axis[k], about, angle);
        arm = dem__rotated(arm, about, angle);
    }
    return dem__add(dem__add(w->spin_centre, arm), pose->shift);
}

static inline void dem__prescribed_wall(dem_wall *w, double time) {
    dem_vec at[3], axis[3][3], omega = dem_vec3(0.0, 0.0, 0.0);
    const double rate = 0.5 / w->interval;
    if (!w->motion) return;
    for (int k = 0; k < 3; k++) {
        dem_pose pose;
        memset(&pose, 0, sizeof pose);
        w->motion(w->motion_user, time + (k - 1) * w->interval, &pose);
        at[k] = dem__posed(w, &pose, axis[k]);
    }
    for (int k = 0; k < 3; k++) { /* w = sum of a x da/dt over the axes, halved */
        w->axis[k] = axis[1][k];
        omega = dem__add(omega, dem__scale(0.5 * rate, dem__cross(axis[1][k], dem__sub(axis[2][k], axis[0][k]))));
    }
    w->position = at[1];
    w->velocity = dem__scale(rate, dem__sub(at[2], at[0]));
    w->acceleration = dem__scale(4.0 * rate * rate, dem__sub(dem__add(at[0], at[2]), dem__scale(2.0, at[1])));
    w->spin = dem__length(omega);
    if (w->spin > 0.0) w->spin_axis = dem__scale(1.0 / w->spin, omega);
}

/* Velocity and acceleration that a controlled wall's rate gives it where it is. */
static inline void dem__rated_wall(dem_wall *w, double rate) {
    if (w->drive == DEM_FORCE_CONTROLLED) {
        w->velocity = dem__scale(rate, w->spin_axis), w->acceleration = dem__scale(w->rate_change, w->spin_axis);
        return;
    }
    const dem_vec arm = dem__sub(w->position, w->spin_centre), across = dem__cross(w->spin_axis, arm);
    w->spin = rate, w->spin_rate = w->rate_change;
    w->velocity = dem__scale(rate, across);
    w->acceleration = dem__add(dem__scale(w->rate_change, across), dem__scale(rate, dem__cross(w->spin_axis, w->velocity)));
}

/* Predicted, as a particle is. */
static inline void dem__controlled_wall(dem_wall *w, double time) {
    const double tau = time - w->motion_start, way = w->coordinate + tau * (w->rate + 0.5 * tau * w->rate_change);
    dem_pose pose;
    memset(&pose, 0, sizeof pose);
    if (w->drive == DEM_FORCE_CONTROLLED) pose.shift = dem__scale(way, w->spin_axis);
    else pose.turn = dem__scale(way, w->spin_axis);
    w->position = dem__posed(w, &pose, w->axis);
    dem__rated_wall(w, w->rate + tau * w->rate_change);
}

/* Puts a kinematic wall where it is t after its motion began. */
static inline void dem__kinematic_wall(dem_wall *w, double t, const dem__sway *sway) {
    const dem_vec shift = dem__add(sway->shift, dem__scale(t, w->drift));
    w->velocity = dem__add(sway->velocity, w->drift);
    w->acceleration = sway->acceleration;
    dem_vec origin = w->origin;
    if (w->spin != 0.0) {
        double angle = w->spin * t;
        for (int k = 0; k < 3; k++) w->axis[k] = dem__rotated(w->rest_axis[k], w->spin_axis, angle);
        dem_vec arm = dem__rotated(dem__sub(w->origin, w->spin_centre), w->spin_axis, angle), omega = dem__scale(w->spin, w->spin_axis);
        dem_vec turning = dem__cross(omega, arm);
        origin = dem__add(w->spin_centre, arm);
        w->velocity = dem__add(w->velocity, turning);
        w->acceleration = dem__add(w->acceleration, dem__cross(omega, turning));
    }
    w->position = dem__add(origin, shift);
}

/* Puts a wall where it is at a time. */
static inline void dem__move_wall(dem_wall *w, double time) {
    if (w->drive == DEM_PRESCRIBED) dem__prescribed_wall(w, time);
    else if (w->drive != DEM_KINEMATIC) dem__controlled_wall(w, time);
    else {
        const dem__sway sway = dem__sway_at(w, time - w->motion_start);
        dem__kinematic_wall(w, time - w->motion_start, &sway);
    }
}

/* One place where a sphere is near a wall. */
typedef struct dem__touch {
    double gap, curvature;
    dem_vec normal; /* from the wall to the sphere */
    int32_t element;
} dem__touch;

enum { DEM__TOUCHES = 4, DEM__NUMBERS = 16 }; /* NUMBERS: of the contacts of a particle with a mesh, those that end this step included */
#define DEM__SMOOTH 0.9 /* cosine of the angle, 26 degrees, up to which facets are one surface: a drum of 16 sides is round */

DEM_INLINE double dem__clamp(double v, double low, double high) { return v < low ? low : (v > high ? high : v); }

/* From the nearest point of the axis of bar `index` of a family, at (index - 1/2) pitch, to a centre: along is its coordinate parallel to
   the bars, across the one over them; (along, across, up) is left in *from. How far from there the surface is, or less than 0 if there is
   no such bar. */
DEM_INLINE double dem__reach_bar(const dem_wall *w, int family, double index, double along, double across, double up, dem_vec *from) {
    const double half = 0.5 * w->wire, bar = (index - 0.5) * (w->aperture + w->wire);
    const double side = family ? w->half_x : w->half_y, length = family ? w->half_y : w->half_x;
    const double end2 = w->circular ? (w->half_x - bar) * (w->half_x + bar) : length * length; /* its half length, squared */
    const int beyond = !(along * along <= end2);
    const double da = !beyond ? 0.0 : along < 0.0 ? along + sqrt(end2) : along - sqrt(end2), dc = across - bar;
    *from = dem_vec3(da, dc, up);
    if (w->circular ? !(fabs(bar) < w->half_x) : !(fabs(bar) <= side)) return -1.0;
    if (w->profile == DEM_ROUND || !(up < 0.0)) return half;
    /* the flat side: as wide as the wire and, seen from below, as round at its ends */
    if (!beyond) {
        from->y = dc - dem__clamp(dc, -half, half);
        return 0.0;
    }
    const double out_by = sqrt(da * da + dc * dc), rest = out_by > half ? (out_by - half) / out_by : 0.0;
    from->x = rest * da, from->y = rest * dc;
    return 0.0;
}

/* Bar `index` of a family as a place that is touched; the normal is left in (along, across, up). Returns 0 if there is no such bar. */
DEM_INLINE int dem__touch_bar(const dem_wall *w, int family, double index, double along, double across, double up, double radius,
                              dem__touch *out) {
    dem_vec from;
    const double inner = dem__reach_bar(w, family, index, along, across, up, &from);
    if (!(inner >= 0.0)) return 0;
    const double distance = dem__length(from);
    out->gap = distance - inner - radius;
    out->curvature = 1.0 / w->wire; /* of the round part everywhere: a contact's constants do not depend on when they are asked for */
    out->normal = dem__scale(1.0 / distance, from);
    out->element = 2 * (int32_t)index + family;
    return distance > 0.0;
}

/* (along, across, up) of a family to the world's axes. */
DEM_INLINE dem_vec dem__from_bar(const dem_wall *w, int family, dem_vec v) {
    const dem_vec a = dem__scale(v.x, w->axis[family]), c = dem__scale(v.y, w->axis[1 - family]), u = dem__scale(v.z, w->axis[2]);
    return dem__add(dem__add(a, c), u);
}

/* Only the two nearest bars of a family count, this one and the next. Beside the deck they are its last. */
DEM_INLINE double dem__nearest_bar(const dem_wall *w, int family, double across) {
    const double pitch = w->aperture + w->wire, half = family ? w->half_x : w->half_y, nearest = floor(across / pitch + 0.5);
    if (fabs(across) < half - pitch) return nearest;
    const double last = floor(half / pitch + 0.5);
    return dem__clamp(nearest, 1.0 - last, last - 1.0);
}

/* Any other is at least this far away, if none overlaps by more: the gap of the nearest, where that is less than 0. */
DEM_INLINE double dem__third_bar(const dem_wall *w, double radius, double lowest) {
    const double pitch = w->aperture + w->wire, sum = radius + 0.5 * w->wire, near = lowest < 0.0 ? sum + lowest : sum;
    return sqrt(near * near + 0.75 * pitch * pitch) - sum;
}

/* The nearest point of a frustum lies in the plane of axis and centre, on a segment. d: the centre, seen from the low end. */
static inline int dem__touch_cone(const dem_wall *w, dem_vec d, double up, double radius, double limit, dem__touch *out, double *least) {
    const dem_vec radial = dem__sub(d, dem__scale(up, w->axis[2]));
    const double rho = dem__length(radial), rise = w->high_radius - w->radius, slant = sqrt(rise * rise + w->length * w->length);
    const dem_vec outward = rho > 0.0 ? dem__scale(1.0 / rho, radial) : w->axis[0]; /* on the axis a ring touches: any of it */
    const double along = dem__clamp(((rho - w->radius) * rise + up * w->length) / (slant * slant), 0.0, 1.0);
    const double x = rho - (w->radius + along * rise), y = up - along * w->length;
    double distance = sqrt(x * x + y * y), nx = w->length / slant, ny = -rise / slant;
    const int on_rim = !(along > 0.0 && along < 1.0);
    if (!on_rim) { /* from the side's own normal, which does not lose its figures near the surface */
        const double side = (rho - w->radius) * nx + up * ny;
        distance = fabs(side);
        if (side < 0.0) nx = -nx, ny = -ny;
    } else if (distance > 0.0) nx = x / distance, ny = y / distance;
    *least = out[0].gap = distance - radius;
    if (!(*least < limit)) return 0;
    out[0].normal = dem__add(dem__scale(nx, outward), dem__scale(ny, w->axis[2]));
    /* half way up: one kind of contact wherever it begins; balls wider than the ring lie on a rim */
    out[0].curvature = on_rim ? 0.0 : (nx < 0.0 ? -1.0 : 1.0) * w->length / (slant * (w->radius + w->high_radius));
    return 1;
}

/* A mesh's triangles in the wall's own frame, in the order of the leaves of a tree of boxes. Its nodes stand in the order of a walk that
   takes the first child first; `skip` is where the walk goes on without a node's children. */
typedef struct dem__node {
    double low[3], high[3];
    int32_t skip, first, count; /* count: triangles of a leaf, else 0 */
} dem__node;
typedef struct dem__tree {
    size_t bytes;
    int32_t vertices, triangles, nodes;
    dem_vec *vertex, *normal;
    int32_t *corner; /* [triangles][3] */
    dem__node *node;
} dem__tree;
enum { DEM__LEAF = 4 };

/* From the nearest point of a triangle to p (Ericson 2005, Real-Time Collision Detection, 5.1.5), and its length. */
static inline dem_vec dem__from_triangle(const dem__tree *t, int32_t k, dem_vec p, double *distance) {
    const dem_vec a = t->vertex[t->corner[3 * k]], b = t->vertex[t->corner[3 * k + 1]], c = t->vertex[t->corner[3 * k + 2]];
    const dem_vec ab = dem__sub(b, a), ac = dem__sub(c, a), ap = dem__sub(p, a), bp = dem__sub(p, b), cp = dem__sub(p, c);
    const double a1 = dem__dot(ab, ap), a2 = dem__dot(ac, ap), b1 = dem__dot(ab, bp), b2 = dem__dot(ac, bp), c1 = dem__dot(ab, cp),
                 c2 = dem__dot(ac, cp);
    const double to_ab = a1 * b2 - b1 * a2, to_ac = c1 * a2 - a1 * c2, to_bc = b1 * c2 - c1 * b2;
    dem_vec v;
    if (a1 <= 0.0 && a2 <= 0.0) v = ap;
    else if (b1 >= 0.0 && b2 <= b1) v = bp;
    else if (c2 >= 0.0 && c1 <= c2) v = cp;
    else if (to_ab <= 0.0 && a1 >= 0.0 && b1 <= 0.0) v = dem__sub(ap, dem__scale(a1 / (a1 - b1), ab));
    else if (to_ac <= 0.0 && a2 >= 0.0 && c2 <= 0.0) v = dem__sub(ap, dem__scale(a2 / (a2 - c2), ac));
    else if (to_bc <= 0.0 && b2 >= b1 && c1 >= c2) v = dem__sub(bp, dem__scale((b2 - b1) / ((b2 - b1) + (c1 - c2)), dem__sub(c, b)));
    else { /* above the face: along its normal, the same for all faces of a plane */ const double up = dem__dot(ap, t->normal[k]);
        *distance = fabs(up);
        return dem__scale(up, t->normal[k]);
    }
    *distance = dem__length(v);
    return v;
}

DEM_INLINE int dem__is_far(const dem__node *b, dem_vec p, double reach) {
    const double x = p.x - dem__clamp(p.x, b->low[0], b->high[0]), y = p.y - dem__clamp(p.y, b->low[1], b->high[1]),
                 z = p.z - dem__clamp(p.z, b->low[2], b->high[2]);
    return !(x * x + y * y + z * z < reach * reach);
}

/* One surface is touched once: a place is in the shadow of a nearer one if their normals agree to 26 degrees, or if it does not rise over
   the nearer one's tangent plane, as edges and corners of a face that is touched do not. */
DEM_INLINE int dem__is_shadowed(const dem__touch *far_one, const dem__touch *near_one, double radius) {
    const double flat = (1.0 - 1e-9) * (radius + near_one->gap) / (radius + far_one->gap);
    return dem__dot(far_one->normal, near_one->normal) > (flat < DEM__SMOOTH ? flat : DEM__SMOOTH);
}

static inline void dem__meet_triangle(const dem__tree *t, int32_t k, dem_vec p, double radius, dem__touch *touch) {
    double distance;
    const dem_vec v = dem__from_triangle(t, k, p, &distance);
    touch->gap = distance - radius;
    touch->normal = distance > 0.0 ? dem__scale(1.0 / distance, v) : t->normal[k];
    touch->curvature = 0.0;
}

/* The nearest place of a mesh, if its gap is below limit; and with a gap below deep, the others that are none's shadow: the nearest
   DEM__TOUCHES, nearest first. */
static inline int dem__touch_mesh(const dem_wall *w, dem_vec d, double radius, double deep, double limit, dem__touch *out, double *least) {
    const dem__tree *t = w->tree;
    const dem_vec p = dem_vec3(dem__dot(d, w->axis[0]), dem__dot(d, w->axis[1]), dem__dot(d, w->axis[2]));
    dem__touch here;
    int n = 0;
    *least = limit;
    for (int32_t b = 0; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, p, radius + *least)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) {
            dem__meet_triangle(t, k, p, radius, &here);
            if (here.gap < *least) *least = here.gap, out[0] = here, n = 1;
        }
    }
    for (int32_t b = *least < deep ? 0 : t->nodes; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, p, radius + deep)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) {
            int at = 0, kept;
            dem__meet_triangle(t, k, p, radius, &here);
            if (!(here.gap < deep)) continue;
            while (at < n && out[at].gap <= here.gap && !dem__is_shadowed(&here, &out[at], radius)) at++;
            if (at == DEM__TOUCHES || (at < n && out[at].gap <= here.gap)) continue;
            kept = at;
            for (int q = at; q < n; q++) { /* it shadows others itself */
                if (!dem__is_shadowed(&out[q], &here, radius)) out[kept++] = out[q];
            }
            n = kept < DEM__TOUCHES ? kept + 1 : DEM__TOUCHES;
            for (int q = n - 1; q > at; q--) out[q] = out[q - 1];
            out[at] = here;
        }
    }
    for (int q = 0; q < n; q++) {
        const dem_vec v = out[q].normal;
        out[q].normal = dem__add(dem__add(dem__scale(v.x, w->axis[0]), dem__scale(v.y, w->axis[1])), dem__scale(v.z, w->axis[2]));
        out[q].element = q;
    }
    return n;
}

/* All places where a sphere's gap to a wall is below limit (at most DEM__TOUCHES; of a mesh the nearest, and those that overlap); *least
   becomes a lower bound of the gap. */
static inline int dem__touch_wall(const dem_wall *w, dem_vec centre, double radius, double limit, dem__touch *out, double *least) {
    dem_vec d = dem__sub(centre, w->position);
    double up = dem__dot(d, w->axis[2]);
    int n = 0;
    out[0].element = 0;
    out[0].curvature = 0.0;
    if (w->kind == DEM_PLANE || w->kind == DEM_EXIT) {
        out[0].gap = up - (w->kind == DEM_PLANE ? radius : 0.0);
        out[0].normal = w->axis[2];
        *least = out[0].gap;
        return out[0].gap < limit;
    }
    if (w->kind == DEM_CYLINDER) {
        dem_vec radial = dem__sub(d, dem__scale(up, w->axis[2]));
        double distance = dem__length(radial);
        out[0].gap = (w->inside ? w->radius - distance : distance - w->radius) - radius;
        *least = out[0].gap;
        if (!(out[0].gap < limit) || !(distance > 0.0)) return 0;
        out[0].normal = dem__scale((w->inside ? -1.0 : 1.0) / distance, radial);
        out[0].curvature = (w->inside ? -0.5 : 0.5) / w->radius;
        return 1;
    }
    if (w->kind == DEM_SPHERE) {
        const double distance = dem__length(d);
        out[0].gap = (w->inside ? w->radius - distance : distance - w->radius) - radius;
        *least = out[0].gap;
        if (!(out[0].gap < limit) || !(distance > 0.0)) return 0;
        out[0].normal = dem__scale((w->inside ? -1.0 : 1.0) / distance, d);
        out[0].curvature = (w->inside ? -1.0 : 1.0) / w->radius;
        return 1;
    }
    if (w->kind == DEM_CONE) return dem__touch_cone(w, d, up, radius, limit, out, least);
    if (w->kind == DEM_MESH) return dem__touch_mesh(w, d, radius, limit < 0.0 ? limit : 0.0, limit, out, least);
    *least = fabs(up) - radius - 0.5 * w->wire;
    if (!(*least < limit)) return 0;
    double bound = HUGE_VAL;
    for (int family = 0; family < 2; family++) {
        const double along = dem__dot(d, w->axis[family]), across = dem__dot(d, w->axis[1 - family]);
        const double nearest = dem__nearest_bar(w, family, across);
        if (!(fabs(nearest) < 1e6)) continue;
        for (int side = 0; side < 2; side++) {
            if (!dem__touch_bar(w, family, nearest + side, along, across, up, radius, &out[n])) continue;
            bound = out[n].gap < bound ? out[n].gap : bound;
            if (!(out[n].gap < limit)) continue;
            out[n].normal = dem__from_bar(w, family, out[n].normal);
            n++;
        }
    }
    const double third = dem__third_bar(w, radius, bound);
    bound = third < bound ? third : bound;
    *least = bound > *least ? bound : *least;
    return n;
}

/* The one place that an element of a wall touches, at any gap. */
static inline void dem__touch_element(const dem_wall *w, dem_vec centre, double radius, int32_t element, dem__touch *out) {
    double least;
    if (w->kind == DEM_SCREEN) {
        const dem_vec d = dem__sub(centre, w->position);
        const int family = (int)((uint32_t)element & 1u);
        const double index = (double)((element - family) / 2);
        out->gap = HUGE_VAL, out->curvature = 0.0, out->normal = w->axis[2];
        if (dem__touch_bar(w, family, index, dem__dot(d, w->axis[family]), dem__dot(d, w->axis[1 - family]), dem__dot(d, w->axis[2]),
                           radius, out))
            out->normal = dem__from_bar(w, family, out->normal);
        return;
    }
    dem__touch touch[DEM__TOUCHES]; /* a mesh may have as many */
    touch[0].gap = HUGE_VAL, touch[0].normal = w->axis[2];
    dem__touch_wall(w, centre, radius, HUGE_VAL, touch, &least);
    *out = touch[0];
}

/* From the axis or centre of a wall that is round at an element to a sphere's centre, and how far from there the surface is. Returns 1 if
   the sphere is outside, -1 if inside, 0 if the place is not round or has no normal. */
static inline double dem__reach_round(const dem_wall *w, dem_vec centre, int32_t element, dem_vec *from, double *inner) {
    const dem_vec d = dem__sub(centre, w->position);
    if (w->kind == DEM_SCREEN) {
        const int family = (int)((uint32_t)element & 1u);
        const double along = dem__dot(d, w->axis[family]), across = dem__dot(d, w->axis[1 - family]), up = dem__dot(d, w->axis[2]);
        *inner = dem__reach_bar(w, family, (double)((element - family) / 2), along, across, up, from);
        *from = dem__from_bar(w, family, *from);
        return *inner >= 0.0 && dem__dot(*from, *from) > 0.0 ? 1.0 : 0.0;
    }
    if (w->kind != DEM_CYLINDER && w->kind != DEM_SPHERE) return 0.0;
    *from = w->kind == DEM_SPHERE ? d : dem__plus(d, -dem__dot(d, w->axis[2]), w->axis[2]);
    *inner = w->radius;
    return !(dem__dot(*from, *from) > 0.0) ? 0.0 : w->inside ? -1.0 : 1.0;
}

/* Velocity and acceleration of a sliding wall's surface at a point, whose normal is n. */
DEM_INLINE dem_vec dem__surface_velocity(const dem_wall *w, dem_vec point, dem_vec n) {
    const dem_vec turning = dem__cross(dem__scale(w->spin, w->spin_axis), dem__sub(point, w->position));
    return dem__add(dem__add(w->velocity, turning), dem__sub(w->belt, dem__scale(dem__dot(w->belt, n), n)));
}
DEM_INLINE dem_vec dem__surface_acceleration(const dem_wall *w, dem_vec point) {
    const dem_vec omega = dem__scale(w->spin, w->spin_axis), arm = dem__sub(point, w->position);
    const dem_vec inward = dem__cross(omega, dem__cross(omega, arm));
    return dem__add(w->acceleration, dem__add(inward, dem__scale(w->spin_rate, dem__cross(w->spin_axis, arm))));
}

#ifdef DEM__BODIES

/* ------------------------------------------------------------------------------------------------ >>memory */

static inline void *dem__default_allocator(void *user, void *old, size_t old_size, size_t new_size) {
    (void)user;
    (void)old_size;
    if (new_size > 0) return realloc(old, new_size);
    free(old);
    return NULL;
}

/* The arrays of a group: their addresses, so that growing, freeing and saving are loops. */
typedef struct dem__array {
    void *address; /* of the pointer */
    size_t size;   /* of an entry */
} dem__array;
enum { DEM__ARRAYS_MAX = 96, DEM__STEP_ARRAYS = 3, DEM__OUT_ARRAYS = 9, DEM__OWN_ARRAYS = 4 };

static inline int dem__particle_arrays(dem_world *w, dem__array *list) {
    int n = 0;
    double **doubles[] = {&w->wall_speed__, &w->shifted__, &w->share__};
    dem__six **sixes[] = {&w->load__, &w->external__, &w->linked__};
    int32_t **integers[] = {&w->material,         &w->group,       &w->alive,   &w->touching,    &w->active__,    &w->wall_head__,
                            &w->adjacent_start__, &w->cell_next__, &w->remap__, &w->is_active__, &w->link_head__, &w->link_loaded__,
                            &w->unsettled__};
    for (size_t k = 0; k < sizeof doubles / sizeof *doubles; k++, n++) {
        list[n].address = doubles[k], list[n].size = sizeof(double);
    }
    for (size_t k = 0; k < sizeof sixes / sizeof *sixes; k++, n++) {
        list[n].address = sixes[k], list[n].size = sizeof(dem__six);
    }
    for (size_t k = 0; k < sizeof integers / sizeof *integers; k++, n++) {
        list[n].address = integers[k], list[n].size = sizeof(int32_t);
    }
    list[n].address = &w->particle, list[n++].size = sizeof(dem_particle);
    list[n].address = &w->spin_rate, list[n++].size = sizeof(dem_vec);
    list[n].address = &w->listed_at__, list[n++].size = sizeof(dem_vec);
    list[n].address = &w->impact__, list[n++].size = sizeof(dem_vec);
    list[n].address = &w->id, list[n++].size = sizeof(uint64_t);
    list[n].address = &w->course__, list[n++].size = sizeof(dem__course);
    list[n].address = &w->sum__, list[n++].size = sizeof(dem__sum);
    return n;
}

static inline int dem__has_deferrals(const dem_world *w) { return w->deferral__ || w->def.threads > 1; }

/* Of contacts, in the order of how long they hold something: from step to step, ... */
static inline int dem__live_arrays(dem_world *w, dem__array *list) {
    int n = 0;
    int32_t **integers[] = {&w->live_i__, &w->live_j__, &w->live_element__, &w->live_near__, &w->live_wall_next__, &w->live_kind__};
    double **own[DEM__OWN_ARRAYS] = {&w->live_predict__, &w->live_mass__, &w->live_sum__, &w->live_part__};
    for (size_t k = 0; k < sizeof integers / sizeof *integers; k++, n++) list[n].address = integers[k], list[n].size = sizeof(int32_t);
    list[n].address = &w->live_gap__, list[n++].size = sizeof(double);
    list[n].address = &w->live_force__, list[n++].size = sizeof(double);
    for (int k = 0; k < w->states__; k++, n++) list[n].address = &w->live_state__[k], list[n].size = sizeof(double);
    for (int k = 0; w->places__ && k < 4; k++, n++) list[n].address = &w->live_place__[k], list[n].size = sizeof(double);
    if (w->ledger_on__) {
        list[n].address = &w->live_elastic__, list[n++].size = sizeof(double);
        for (int k = 0; k < 3; k++, n++) list[n].address = &w->live_power__[k], list[n].size = sizeof(double);
        for (int k = 0; k < 4; k++, n++) list[n].address = &w->live_loss__[k], list[n].size = sizeof(double);
    }
    list[n].address = &w->live_ended__, list[n++].size = 1;
    /* ... with constants of their own, ... */
    for (int k = 0; k < DEM__OWN_ARRAYS; k++, n++) list[n].address = own[k], list[n].size = sizeof(double);
    for (int k = 0; k < w->constants__; k++, n++) list[n].address = &w->live_constant__[k], list[n].size = sizeof(double);
    /* ... after the last step of a run, ... */
    for (int k = 0; k < DEM__OUT_ARRAYS; k++, n++) list[n].address = &w->live_out__[k], list[n].size = sizeof(double);
    /* ... within a step */
    list[n].address = &w->live_handed__, list[n++].size = sizeof(dem__handed);
    list[n].address = &w->live_event__, list[n++].size = 1;
    list[n].address = &w->slots__, list[n++].size = sizeof(int32_t);
    if (dem__has_deferrals(w)) list[n].address = &w->deferral__, list[n++].size = sizeof(dem__deferral);
    return n;
}

/* Of those the first so many hold something when a contact is moved to another slot. */
static inline int dem__held_arrays(dem_world *w, dem__array *list) {
    const int with_out = dem__live_arrays(w, list) - dem__has_deferrals(w) - DEM__STEP_ARRAYS, with_own = with_out - DEM__OUT_ARRAYS;
    return w->keeps_out__ ? with_out : w->kinds__ > DEM_KINDS_MAX ? with_own : with_own - DEM__OWN_ARRAYS - w->constants__;
}

/* All arrays of a group lie in one block, so that growing works for all or changes nothing. Each begins with a cache line. */
static inline int dem__grow_group(dem_world *w, const dem__array *list, int n, void **block, size_t *bytes, ptrdiff_t *capacity,
                                  ptrdiff_t wanted) {
    ptrdiff_t larger = *capacity + *capacity / 2 + 64;
    size_t total = 64;
    if (larger < wanted) larger = wanted;
    for (int k = 0; k < n; k++) {
        if ((size_t)larger > (SIZE_MAX / 4 - total) / list[k].size) return 0;
        total += ((size_t)larger * list[k].size + 63) & ~(size_t)63;
    }
    char *fresh = (char *)w->def.allocator.fn(w->def.allocator.user, NULL, 0, total), *at = fresh;
    if (!fresh) return 0;
    memset(fresh, 0, total);
    at += 64 - (size_t)((uintptr_t)fresh & 63);
    for (int k = 0; k < n; k++) {
        void *old = NULL, *now = at;
        memcpy(&old, list[k].address, sizeof old);
        if (old && *capacity > 0) memcpy(now, old, (size_t)*capacity * list[k].size);
        memcpy(list[k].address, &now, sizeof now);
        at += ((size_t)larger * list[k].size + 63) & ~(size_t)63;
    }
    if (*block) w->def.allocator.fn(w->def.allocator.user, *block, *bytes, 0);
    *block = fresh;
    *bytes = total;
    *capacity = larger;
    return 1;
}

static inline int dem__link_arrays(dem_world *w, dem__array *list) {
    int n = 0;
    int32_t **integers[] = {&w->link_i__, &w->link_j__, &w->link_element__, &w->link_next_i__, &w->link_next_j__};
    for (size_t k = 0; k < sizeof integers / sizeof *integers; k++, n++) list[n].address = integers[k], list[n].size = sizeof(int32_t);
    for (int k = 0; k < w->link_states__; k++, n++) list[n].address = &w->link_state__[k], list[n].size = sizeof(double);
    for (int k = 0; k < 9; k++, n++) list[n].address = &w->link_out__[k], list[n].size = sizeof(double);
    list[n].address = &w->link_gap__, list[n++].size = sizeof(double);
    list[n].address = &w->link_ended__, list[n++].size = 1;
    return n;
}

/* Room for so many timers, and for what else is kept of each, so many bytes. */
static inline int dem__grow_timers(dem_world *w, dem__timers *t, ptrdiff_t count, void *other, size_t bytes) {
    const dem__array list[] = {{&t->due, DEM__BUNCH * sizeof *t->due},
                               {&t->list, DEM__BUNCH * sizeof *t->list},
                               {&t->earliest, sizeof *t->earliest},
                               {other, DEM__BUNCH * bytes}};
    const ptrdiff_t bunches = (count / DEM__SHEAF + 1) * DEM__BUNCH;
    return bunches <= t->capacity || dem__grow_group(w, list, 4, &t->block, &t->bytes, &t->capacity, bunches);
}
static inline int dem__grow_near(dem_world *w, ptrdiff_t count) {
    return dem__grow_timers(w, &w->pair_timers__, count, &w->near__, sizeof *w->near__);
}

/* So many timers, of which those from `kept` on are stopped. */
static inline void dem__stop_timers(dem__timers *t, ptrdiff_t kept, ptrdiff_t count) {
    t->sheaves = count / DEM__SHEAF + 1;
    for (ptrdiff_t e = kept; e < t->sheaves * DEM__SHEAF; e++) t->due[e] = DEM__STOPPED;
    for (ptrdiff_t b = 0; b < t->sheaves * DEM__BUNCH; b++) {
        t->earliest[b] = DEM__STOPPED;
        for (const int32_t *due = t->due + b * DEM__BUNCH, *end = due + DEM__BUNCH; due < end; due++)
            t->earliest[b] = *due < t->earliest[b] ? *due : t->earliest[b];
    }
}

/* Steps counted from another one. */
static inline void dem__count_from(dem__timers *t, int64_t step) {
    const int32_t later = (int32_t)(step - t->from);
    for (ptrdiff_t e = 0; e < t->sheaves * DEM__SHEAF; e++) t->due[e] -= t->due[e] < DEM__NEVER ? later : 0;
    for (ptrdiff_t b = 0; b < t->sheaves * DEM__BUNCH; b++) t->earliest[b] -= t->earliest[b] < DEM__NEVER ? later : 0;
    t->from = step;
}

/* One plain array as a group of its own. */
static inline int dem__grow_one(dem_world *w, int32_t **array, ptrdiff_t *capacity, ptrdiff_t wanted) {
    if (wanted <= *capacity) return 1;
    ptrdiff_t larger = wanted + wanted / 4 + 64;
    int32_t *fresh = (int32_t *)w->def.allocator.fn(w->def.allocator.user, NULL, 0, (size_t)larger * sizeof *fresh);
    if (!fresh) return 0;
    if (*array) w->def.allocator.fn(w->def.allocator.user, *array, (size_t)*capacity * sizeof **array, 0);
    *array = fresh;
    *capacity = larger;
    return 1;
}

/* -------------------------------------------------------------------------------------------- >>definition */

DEM_API const char *dem_status_text(dem_status status) {
    switch (status) {
#define DEM__CASE(name, text)                                                                                                              \
    case name: return text;
        DEM_STATUSES(DEM__CASE)
#undef DEM__CASE
    case DEM_STATUS_COUNT: break;
    }
    return "unknown status";
}

DEM_API int dem_build_is_deterministic(void) {
    volatile double a = 1.0 + 0x1p-30, b = 1.0 - 0x1p-30, c = -1.0;
    double x = a, y = b, z = c, fused = x * y + z; /* exactly -2^-60 if fused, 0 if not */
    return (FLT_EVAL_METHOD == 0 || FLT_EVAL_METHOD == 1) && fused == 0.0;
}

DEM_API dem_def dem_default_def(void) {
    dem_def def;
    memset(&def, 0, sizeof def);
    def.cookie = 0x6d656452u;
    def.threads = 1;
    def.skip = DEM_SKIP_ALL;
    def.dt = 1e-6;
    def.skin = 0.35;
    def.gravity = dem_vec3(0.0, 0.0, -9.81);
    def.high = dem_vec3(1.0, 1.0, 1.0);
    def.allocator.fn = dem__default_allocator;
    for (int a = 0; a < DEM_MATERIALS_MAX; a++) {
        for (int b = 0; b < DEM_MATERIALS_MAX; b++) {
            dem_pair_def *pair = &def.pair[a][b];
            pair->stiffness = 1e5;
            pair->tangential_ratio = 2.0 / 7.0;
            pair->restitution = 0.8;
            pair->friction = 0.3;
        }
    }
    return def;
}

DEM_API int dem_add_material(dem_def *def, double density, double young_modulus, double poisson_ratio) {
    if (!def || def->materials < 0 || def->materials >= DEM_MATERIALS_MAX) return -1;
    dem_material *material = &def->material[def->materials];
    material->density = density;
    material->young_modulus = young_modulus;
    material->poisson_ratio = poisson_ratio;
    return def->materials++;
}

DEM_API dem_pair_def *dem_pair(dem_def *def, int a, int b) {
    if (!def || a < 0 || b < 0 || a >= DEM_MATERIALS_MAX || b >= DEM_MATERIALS_MAX) return NULL;
    return a < b ? &def->pair[a][b] : &def->pair[b][a];
}

static inline int dem__finite(double v) { return fabs(v) <= DBL_MAX; }
static inline int dem__finite_vec(dem_vec v) { return dem__finite(v.x) && dem__finite(v.y) && dem__finite(v.z); }
static inline int dem__positive(double v) { return v > 0.0 && v <= DBL_MAX; }
static inline int dem__not_negative(double v) { return v >= 0.0 && v <= DBL_MAX; }

static const char *dem__bad_pair(const dem_pair_def *p) {
    if (!dem__positive(p->stiffness)) return "pair.stiffness";
    if (!(p->tangential_ratio >= 0.0 && p->tangential_ratio <= 1.0)) return "pair.tangential_ratio";
    if (!(p->restitution > 0.0 && p->restitution <= 1.0)) return "pair.restitution";
    if (!dem__not_negative(p->friction)) return "pair.friction";
    if (!dem__not_negative(p->rolling)) return "pair.rolling";
    if (!dem__not_negative(p->tangential_damping)) return "pair.tangential_damping";
    if (p->mode != DEM_CLIPPED && p->mode != DEM_NAIVE) return "pair.mode";
    return NULL;
}

static const char *dem__bad_field(const dem_def *def) {
    if (!def) return "def";
    if (def->cookie != 0x6d656452u) return "cookie";
    if (def->materials < 1 || def->materials > DEM_MATERIALS_MAX) return "materials";
    if (def->threads < 1 || def->threads > 4096) return "threads";
    if (def->skip < 0 || def->skip > DEM_SKIP_ALL) return "skip";
    if (!(def->dt > 0.0 && def->dt < 1e6)) return "dt";
    if (!(def->skin > 0.0 && def->skin < 100.0)) return "skin";
    if (!dem__finite_vec(def->gravity)) return "gravity";
    for (int a = 0; a < 3; a++) {
        const double low = dem_axis(def->low, a), high = dem_axis(def->high, a);
        if (def->periodic[a] != 0 && def->periodic[a] != 1) return "periodic";
        if (def->periodic[a] && !dem__positive(high - low)) return "high";
    }
    if (!def->allocator.fn) return "allocator.fn";
    for (int a = 0; a < def->materials; a++) {
        if (!dem__positive(def->material[a].density)) return "material.density";
        if (!dem__positive(def->material[a].young_modulus)) return "material.young_modulus";
        if (!(def->material[a].poisson_ratio >= 0.0 && def->material[a].poisson_ratio <= 0.5)) return "material.poisson_ratio";
        for (int b = a; b < def->materials; b++) {
            const char *bad = dem__bad_pair(&def->pair[a][b]);
            if (bad) return bad;
        }
    }
    return NULL;
}

DEM_API dem_status dem_check_def(const dem_def *def, const char **field) {
    const char *bad = dem__bad_field(def);
    if (field) *field = bad;
    return bad ? DEM_BAD_DEFINITION : DEM_OK;
}

DEM_API dem_status dem_init(dem_world *world, const dem_def *def, const char **field) {
    if (!world) return DEM_BAD_ARGUMENT;
    memset(world, 0, sizeof *world);
    dem_status status = dem_check_def(def, field);
    if (status != DEM_OK) return status;
    world->def = *def;
    world->dt__ = def->dt;
    world->fresh__ = world->stale__ = world->sections__ = 1;
    world->has_periodic__ = def->periodic[0] | def->periodic[1] | def->periodic[2];
    return DEM_OK;
}

DEM_API void dem_free(dem_world *world) {
    if (!world || !world->def.allocator.fn) return;
    dem_allocator a = world->def.allocator;
    if (world->particle_block__) a.fn(a.user, world->particle_block__, world->particle_bytes__, 0);
    if (world->live_block__) a.fn(a.user, world->live_block__, world->live_bytes__, 0);
    if (world->link_block__) a.fn(a.user, world->link_block__, world->link_bytes__, 0);
    if (world->pair_timers__.block) a.fn(a.user, world->pair_timers__.block, world->pair_timers__.bytes, 0);
    if (world->wall_timers__.block) a.fn(a.user, world->wall_timers__.block, world->wall_timers__.bytes, 0);
    if (world->adjacent__) a.fn(a.user, world->adjacent__, (size_t)world->adjacent_capacity__ * sizeof(int32_t), 0);
    if (world->cells__) a.fn(a.user, world->cells__, (size_t)world->cells_capacity__ * sizeof(int32_t), 0);
    if (world->passed) a.fn(a.user, world->passed, (size_t)world->passed_capacity__ * sizeof *world->passed, 0);
    for (int k = 0; k < world->walls; k++) {
        if (world->wall[k].tree) a.fn(a.user, world->wall[k].tree, world->wall[k].tree->bytes, 0);
    }
    memset(world, 0, sizeof *world);
}

/* ------------------------------------------------------------------------------------------------- >>scene */

DEM_INLINE double dem__now(const dem_world *w, ptrdiff_t i) { return (double)(w->step - w->particle[i].origin) * w->dt__; }

DEM_INLINE double dem__wrapped(double v, double low, double high) {
    if (v >= low && v < high) return v;
    const double length = high - low, x = v - length * floor((v - low) / length);
    return x < low ? low : x > high ? high : x; /* what is very far away has no place left but that */
}

/* Position on the parabola at tau after the origin step. */
DEM_INLINE dem_vec dem__at(const dem_world *w, ptrdiff_t i, double tau) {
    const dem_particle *p = &w->particle[i];
    return dem__plus(p->x, tau, dem__plus(p->v, 0.5 * tau, p->a));
}
DEM_INLINE dem_vec dem__in_box(const dem_world *w, dem_vec x) {
    const dem_def *d = &w->def;
    if (d->periodic[0]) x.x = dem__wrapped(x.x, d->low.x, d->high.x);
    if (d->periodic[1]) x.y = dem__wrapped(x.y, d->low.y, d->high.y);
    if (d->periodic[2]) x.z = dem__wrapped(x.z, d->low.z, d->high.z);
    return x;
}
DEM_INLINE dem_vec dem__velocity_at(const dem_world *w, ptrdiff_t i, double tau) {
    return dem__plus(w->particle[i].v, tau, w->particle[i].a);
}

DEM_INLINE dem_vec dem__spin_at(const dem_world *w, ptrdiff_t i, double tau) {
    return dem__plus(w->particle[i].spin, tau, w->spin_rate[i]);
}

/* Makes the present step the origin: the parabola's state becomes the stored one. */
static inline void dem__settle(dem_world *w, ptrdiff_t i) {
    const double tau = dem__now(w, i);
    dem_particle *p = &w->particle[i];
    p->x = dem__at(w, i, tau), p->v = dem__velocity_at(w, i, tau), p->spin = dem__spin_at(w, i, tau);
    w->particle[i].origin = w->step;
}

/* Puts a stored position back into the periodic box. Where gravity has a part along the box it regains potential energy. */
DEM_INLINE void dem__wrap(dem_world *w, ptrdiff_t i) {
    dem_particle *p = &w->particle[i];
    const dem_vec x = dem__in_box(w, p->x);
    if (w->ledger_on__) {
        const double raised = -p->mass * dem__dot(w->def.gravity, dem__sub(x, p->x));
        w->ledger__.added += raised, w->ledger__.added_potential += raised;
    }
    p->x = x;
}

DEM_INLINE double dem__inertia(const dem_world *w, ptrdiff_t i) {
    return 0.4 * w->particle[i].mass * w->particle[i].radius * w->particle[i].radius;
}

DEM_INLINE double dem__kinetic(const dem_world *w, ptrdiff_t i) {
    dem_vec v = dem__velocity_at(w, i, dem__now(w, i));
    return 0.5 * w->particle[i].mass * dem__dot(v, v);
}
DEM_INLINE double dem__rotational(const dem_world *w, ptrdiff_t i) {
    const dem_vec s = dem__spin_at(w, i, dem__now(w, i));
    return 0.5 * dem__inertia(w, i) * dem__dot(s, s);
}
DEM_INLINE double dem__potential(const dem_world *w, ptrdiff_t i) {
    return -w->particle[i].mass * dem__dot(w->def.gravity, dem__at(w, i, dem__now(w, i)));
}

DEM_INLINE double dem__nearest(double d, double length) { return fabs(d) < 0.499999 * length ? d : d - length * floor(d / length + 0.5); }

DEM_INLINE dem_vec dem__apart(const dem_world *w, dem_vec d) {
    if (w->has_periodic__) {
        if (w->def.periodic[0]) d.x = dem__nearest(d.x, w->def.high.x - w->def.low.x);
        if (w->def.periodic[1]) d.y = dem__nearest(d.y, w->def.high.y - w->def.low.y);
        if (w->def.periodic[2]) d.z = dem__nearest(d.z, w->def.high.z - w->def.low.z);
    }
    return d;
}

DEM_INLINE dem_vec dem__first(const double *six) { return dem_vec3(six[0], six[1], six[2]); }
DEM_INLINE dem_vec dem__second(const double *six) { return dem_vec3(six[3], six[4], six[5]); }

/* Steps between two evaluations of the links: also of a loaded world that has not got their law again. */
DEM_INLINE int dem__link_stride(const dem_world *w) {
    const double n = floor(w->link_interval__ / w->dt__);
    return n < 1.0 ? 1 : n > 1000.0 ? 1000 : (int)n;
}

/* Work of the present link forces on particle i since they were evaluated. */
static inline double dem__link_work(const dem_world *w, ptrdiff_t i) {
    if (!w->link_loaded__[i]) return 0.0;
    const double tau = dem__now(w, i), turned = 0.5 * w->dt__ * (double)((w->step - 1) % dem__link_stride(w) + 1);
    const dem_vec way = dem__apart(w, dem__sub(dem__at(w, i, tau), dem__first(w->linked__[i])));
    const dem_vec force = dem__sub(dem__first(w->load__[i]), dem__first(w->external__[i]));
    const dem_vec torque = dem__sub(dem__second(w->load__[i]), dem__second(w->external__[i]));
    return dem__dot(force, way) + turned * dem__dot(torque, dem__add(dem__spin_at(w, i, tau), dem__second(w->linked__[i])));
}

/* What makes accelerations of forces on particle i. */
static inline void dem__weigh(dem_world *w, ptrdiff_t i) {
    dem__sum *sum = &w->sum__[i];
    sum->per_mass = 1.0 / w->particle[i].mass;
    sum->per_inertia = 2.5 * sum->per_mass / (w->particle[i].radius * w->particle[i].radius);
}

/* Acceleration without contacts. */
static inline void dem__free_acceleration(dem_world *w, ptrdiff_t i) {
    const dem__sum *sum = &w->sum__[i];
    w->particle[i].a = dem__plus(w->def.gravity, sum->per_mass, dem__first(w->load__[i]));
    w->spin_rate[i] = dem__scale(sum->per_inertia, dem__second(w->load__[i]));
}

DEM_INLINE double dem__sphere_mass(const dem_world *w, int material, double radius) {
    const double d = 2.0 * radius;
    return RIDDLE_PI / 6.0 * d * d * d * w->def.material[material].density;
}

/* A diameter whose mass and inertia are numbers. */
static inline int dem__is_size(const dem_world *w, int material, double d) {
    return dem__positive(d) && dem__positive(dem__sphere_mass(w, material, 0.5 * d) * d * d);
}

DEM_API dem_status dem_add_spheres(dem_world *world, ptrdiff_t n, const double *centres, const double *diameters, int material, int group) {
    dem_world *w = world;
    if (!w || !w->def.allocator.fn || n < 0 || (n > 0 && (!centres || !diameters)) || material < 0 || material >= w->def.materials)
        return DEM_BAD_ARGUMENT;
    if (n > INT32_MAX / 4 - w->count) return DEM_TOO_MANY;
    for (ptrdiff_t k = 0; k < n; k++) {
        if (!dem__is_size(w, material, diameters[k]) || !dem__finite(centres[3 * k]) || !dem__finite(centres[3 * k + 1]) ||
            !dem__finite(centres[3 * k + 2]))
            return DEM_BAD_ARGUMENT;
    }
    if (w->count + n + 1 > w->capacity__) {
        dem__array list[DEM__ARRAYS_MAX];
        int arrays = dem__particle_arrays(w, list);
        if (!dem__grow_group(w, list, arrays, &w->particle_block__, &w->particle_bytes__, &w->capacity__, w->count + n + 1))
            return DEM_OUT_OF_MEMORY;
    }
    for (ptrdiff_t k = 0; k < n; k++) {
        ptrdiff_t i = w->count++;
        const double d = diameters[k];
        dem_particle *p = &w->particle[i];
        p->x = dem__in_box(w, dem_vec3(centres[3 * k], centres[3 * k + 1], centres[3 * k + 2]));
        p->v = dem_vec3(0.0, 0.0, 0.0);
        p->spin = dem_vec3(0.0, 0.0, 0.0);
        for (int a = 0; a < 6; a++) w->load__[i][a] = w->external__[i][a] = 0.0;
        p->radius = 0.5 * d;
        p->mass = RIDDLE_PI / 6.0 * d * d * d * w->def.material[material].density;
        dem__weigh(w, i);
        w->particle[i].origin = w->step;
        w->id[i] = w->next_id__++;
        w->material[i] = material;
        w->group[i] = group;
        w->alive[i] = 1;
        w->touching[i] = w->is_active__[i] = 0;
        w->wall_head__[i] = w->link_head__[i] = -1;
        w->link_loaded__[i] = 0;
        memset(&w->course__[i], 0, sizeof w->course__[i]);
        w->impact__[i] = dem_vec3(0.0, 0.0, 0.0);
        dem__free_acceleration(w, i);
        if (w->ledger_on__) {
            w->ledger__.added += dem__potential(w, i);
            w->ledger__.added_potential += dem__potential(w, i);
        }
    }
    if (n > 0) w->fresh__ = w->stale__ = 1;
    return DEM_OK;
}

static inline void dem__set_stride(dem_world *w) {
    if (w->link_law__) w->link_stride__ = dem__link_stride(w);
}

DEM_API dem_status dem_set_time_step(dem_world *world, double dt) {
    dem_world *w = world;
    if (!w || !w->def.allocator.fn || !(dt > 0.0 && dt < 1e6)) return DEM_BAD_ARGUMENT;
    for (ptrdiff_t i = 0; i < w->count; i++) dem__settle(w, i);
    w->start_time__ = w->time;
    w->start_step__ = w->step;
    w->def.dt = w->dt__ = dt;
    dem__set_stride(w);
    w->stale__ = w->fresh__ = 1;
    return DEM_OK;
}

DEM_INLINE int dem__is_loaded(const dem_world *w, ptrdiff_t i) {
    const double *e = w->external__[i];
    return e[0] != 0.0 || e[1] != 0.0 || e[2] != 0.0 || e[3] != 0.0 || e[4] != 0.0 || e[5] != 0.0;
}

static inline int dem__is_present(const dem_world *w, ptrdiff_t i) { return w && i >= 0 && i < w->count && w->alive[i]; }

DEM_API dem_status dem_set_motion(dem_world *world, ptrdiff_t i, dem_vec velocity, dem_vec spin) {
    dem_world *w = world;
    if (!dem__is_present(w, i) || !dem__finite_vec(velocity) || !dem__finite_vec(spin)) return DEM_BAD_ARGUMENT;
    if (w->ledger_on__) w->ledger__.added -= dem__kinetic(w, i) + dem__rotational(w, i);
    dem__settle(w, i);
    w->particle[i].v = velocity;
    w->particle[i].spin = spin;
    if (w->ledger_on__) w->ledger__.added += dem__kinetic(w, i) + dem__rotational(w, i);
    w->stale__ = 1;
    return DEM_OK;
}

DEM_API dem_status dem_set_load(dem_world *world, ptrdiff_t i, dem_vec force, dem_vec torque) {
    dem_world *w = world;
    if (!dem__is_present(w, i) || !dem__finite_vec(force) || !dem__finite_vec(torque)) return DEM_BAD_ARGUMENT;
    dem__settle(w, i);
    double *load = w->load__[i], *external = w->external__[i];
    dem_vec *const rate[] = {&w->particle[i].a, &w->spin_rate[i]};
    const double wanted[] = {force.x, force.y, force.z, torque.x, torque.y, torque.z};
    for (int a = 0; a < 6; a++) {
        const double change = wanted[a] - external[a];
        *dem_axis_of(rate[a / 3], a % 3) += change / (a < 3 ? w->particle[i].mass : dem__inertia(w, i));
        load[a] = !w->link_loaded__[i] ? wanted[a] : load[a] + change;
        external[a] = wanted[a];
    }
    if (!w->touching[i]) dem__free_acceleration(w, i);
    if (!w->is_active__[i]) { /* a loaded particle is no free flight: it takes steps */
        w->is_active__[i] = 1;
        w->active__[w->active_count__++] = (int32_t)i;
    }
    w->loads_on__ = w->stale__ = 1;
    return DEM_OK;
}

static inline int dem__unit(dem_vec v, dem_vec *unit) {
    double length = dem__length(v);
    if (!dem__positive(length)) return 0;
    *unit = dem__scale(1.0 / length, v);
    return 1;
}

/* Completes a frame whose third axis is given: first axis near `along`, or any if that is parallel. */
static inline int dem__frame(dem_wall *wall, dem_vec normal, dem_vec along) {
    dem_vec z, x;
    if (!dem__unit(normal, &z)) return 0;
    x = dem__sub(along, dem__scale(dem__dot(along, z), z));
    if (!(dem__length(x) > 1e-6)) {
        dem_vec other = fabs(z.x) < 0.9 ? dem_vec3(1, 0, 0) : dem_vec3(0, 1, 0);
        x = dem__sub(other, dem__scale(dem__dot(other, z), z));
    }
    if (!dem__unit(x, &x)) return 0;
    wall->axis[0] = wall->rest_axis[0] = x;
    wall->axis[1] = wall->rest_axis[1] = dem__cross(z, x);
    wall->axis[2] = wall->rest_axis[2] = z;
    return 1;
}

static inline int dem__add_wall(dem_world *w, const dem_wall *wall) {
    if (w->walls >= DEM_WALLS_MAX) return -(int)DEM_TOO_MANY;
    w->wall[w->walls] = *wall;
    w->wall[w->walls].enabled = 1;
    w->wall[w->walls].position = wall->origin;
    w->wall[w->walls].motion_start = w->time;
    w->stale__ = w->fresh__ = 1;
    return w->walls++;
}

static inline int dem__add_flat(dem_world *w, int kind, int material, dem_vec point, dem_vec normal) {
    dem_wall wall;
    memset(&wall, 0, sizeof wall);
    if (!w || material < 0 || material >= w->def.materials || !dem__finite_vec(point) || !dem__finite_vec(normal))
        return -(int)DEM_BAD_ARGUMENT;
    if (!dem__frame(&wall, normal, dem_vec3(1, 0, 0))) return -(int)DEM_BAD_ARGUMENT;
    wall.kind = kind;
    wall.material = material;
    wall.origin = point;
    return dem__add_wall(w, &wall);
}

DEM_API int dem_add_plane(dem_world *world, int material, dem_vec point, dem_vec normal) {
    return dem__add_flat(world, DEM_PLANE, material, point, normal);
}
DEM_API int dem_add_exit(dem_world *world, dem_vec point, dem_vec normal) { return dem__add_flat(world, DEM_EXIT, 0, point, normal); }

static inline int dem__add_round(dem_world *w, int kind, int material, dem_vec point, dem_vec axis, double radius, int inside) {
    dem_wall wall;
    memset(&wall, 0, sizeof wall);
    if (!w || material < 0 || material >= w->def.materials || !dem__finite_vec(point) || !dem__finite_vec(axis) || !dem__positive(radius))
        return -(int)DEM_BAD_ARGUMENT;
    if (!dem__frame(&wall, axis, dem_vec3(1, 0, 0))) return -(int)DEM_BAD_ARGUMENT;
    wall.kind = kind;
    wall.material = material;
    wall.origin = point;
    wall.radius = radius;
    wall.inside = inside != 0;
    return dem__add_wall(w, &wall);
}

DEM_API int dem_add_cylinder(dem_world *world, int material, dem_vec point, dem_vec axis, double radius, int inside) {
    return dem__add_round(world, DEM_CYLINDER, material, point, axis, radius, inside);
}
DEM_API int dem_add_sphere_wall(dem_world *world, int material, dem_vec centre, double radius, int inside) {
    return dem__add_round(world, DEM_SPHERE, material, centre, dem_vec3(0, 0, 1), radius, inside);
}

/* Room for what a mesh or a cone keeps of each contact. */
static inline int dem__make_places(dem_world *w) {
    dem__array list[DEM__ARRAYS_MAX];
    if (w->places__++ > 0 || w->live_capacity__ == 0) return 1;
    if (dem__grow_group(w, list, dem__live_arrays(w, list), &w->live_block__, &w->live_bytes__, &w->live_capacity__, w->live_capacity__))
        return 1;
    w->places__--;
    return 0;
}

DEM_API dem_cone dem_default_cone(void) {
    dem_cone c;
    c.low = dem_vec3(0, 0, 0);
    c.high = dem_vec3(0, 0, 0.1);
    c.low_radius = 0.02;
    c.high_radius = 0.1;
    return c;
}

DEM_API int dem_add_cone(dem_world *world, int material, const dem_cone *cone) {
    dem_wall wall;
    memset(&wall, 0, sizeof wall);
    if (!world || !world->def.allocator.fn || !cone || material < 0 || material >= world->def.materials || !dem__finite_vec(cone->low) ||
        !dem__finite_vec(cone->high))
        return -(int)DEM_BAD_ARGUMENT;
    const dem_vec axis = dem__sub(cone->high, cone->low);
    if (!dem__not_negative(cone->low_radius) || !dem__not_negative(cone->high_radius) ||
        !dem__positive(cone->low_radius + cone->high_radius) || !dem__frame(&wall, axis, dem_vec3(1, 0, 0)))
        return -(int)DEM_BAD_ARGUMENT;
    wall.kind = DEM_CONE;
    wall.material = material;
    wall.origin = cone->low;
    wall.radius = cone->low_radius;
    wall.high_radius = cone->high_radius;
    wall.length = dem__length(axis);
    return dem__make_places(world) ? dem__add_wall(world, &wall) : -(int)DEM_OUT_OF_MEMORY;
}

DEM_API dem_screen dem_default_screen(void) {
    dem_screen s;
    memset(&s, 0, sizeof s);
    s.aperture = 8e-3;
    s.wire = 2e-3;
    s.profile = DEM_SEMICIRCLE;
    s.circular = 1;
    s.half_x = s.half_y = 0.095;
    s.normal = dem_vec3(0, 0, 1);
    s.direction = dem_vec3(1, 0, 0);
    return s;
}

/* Has a screen lengths, and no more bars and apertures than integers count? */
static inline int dem__is_deck(const dem_wall *w) {
    const double pitch = w->aperture + w->wire, x = w->half_x / pitch, y = w->half_y / pitch;
    return dem__positive(w->aperture) && dem__positive(w->wire) && x > 0.0 && y > 0.0 && x < 1e5 && y < 1e5 && x * y < 2.5e8;
}

DEM_API int dem_add_screen(dem_world *world, int material, const dem_screen *screen) {
    dem_wall wall;
    memset(&wall, 0, sizeof wall);
    if (!world || !screen || material < 0 || material >= world->def.materials || !dem__finite_vec(screen->centre) ||
        !dem__finite_vec(screen->normal) || !dem__finite_vec(screen->direction))
        return -(int)DEM_BAD_ARGUMENT;
    if (screen->profile != DEM_ROUND && screen->profile != DEM_SEMICIRCLE) return -(int)DEM_BAD_ARGUMENT;
    if (!dem__frame(&wall, screen->normal, screen->direction)) return -(int)DEM_BAD_ARGUMENT;
    wall.kind = DEM_SCREEN;
    wall.material = material;
    wall.origin = screen->centre;
    wall.aperture = screen->aperture;
    wall.wire = screen->wire;
    wall.profile = (int)screen->profile;
    wall.circular = screen->circular != 0;
    wall.half_x = screen->half_x;
    wall.half_y = screen->circular ? screen->half_x : screen->half_y;
    if (!dem__is_deck(&wall)) return -(int)DEM_BAD_ARGUMENT;
    return dem__add_wall(world, &wall);
}

/* Every third bit of a Morton code, from 21 bits. */
static inline uint64_t dem__interleave(uint64_t v) {
    v = (v | v << 32) & 0x1f00000000ffffu;
    v = (v | v << 16) & 0x1f0000ff0000ffu;
    v = (v | v << 8) & 0x100f00f00f00f00fu;
    v = (v | v << 4) & 0x10c30c30c30c30c3u;
    return (v | v << 2) & 0x1249249249249249u;
}

/* Sorts by key, then index; temporary has room for n. */
typedef struct dem__keyed {
    uint64_t key;
    int32_t index;
} dem__keyed;
static inline void dem__sort_keyed(dem__keyed *items, dem__keyed *temporary, ptrdiff_t n) {
    for (ptrdiff_t width = 1; width < n; width *= 2) {
        for (ptrdiff_t low = 0; low < n; low += 2 * width) {
            const ptrdiff_t mid = low + width < n ? low + width : n, high = mid + width < n ? mid + width : n;
            for (ptrdiff_t a = low, b = mid, to = low; to < high; to++) {
                const int left = a < mid && (b >= high || items[a].key < items[b].key ||
                                             (items[a].key == items[b].key && items[a].index < items[b].index));
                temporary[to] = left ? items[a++] : items[b++];
            }
        }
        memcpy(items, temporary, (size_t)n * sizeof *items);
    }
}

/* Nodes for the triangles first .. end-1, which are sorted along a space-filling curve: halves of halves. */
static inline void dem__grow_node(dem__tree *t, int32_t first, int32_t end) {
    const int32_t at = t->nodes++;
    dem__node *node = &t->node[at];
    node->first = first;
    node->count = end - first <= DEM__LEAF ? end - first : 0;
    for (int a = 0; a < 3; a++) node->low[a] = HUGE_VAL, node->high[a] = -HUGE_VAL;
    for (int32_t k = 3 * first; k < 3 * (first + node->count); k++) {
        for (int a = 0; a < 3; a++) {
            const double v = dem_axis(t->vertex[t->corner[k]], a);
            node->low[a] = v < node->low[a] ? v : node->low[a];
            node->high[a] = v > node->high[a] ? v : node->high[a];
        }
    }
    if (node->count == 0) {
        const int32_t middle = first + (end - first) / 2;
        for (int side = 0; side < 2; side++) {
            const int32_t child = t->nodes;
            dem__grow_node(t, side ? middle : first, side ? end : middle);
            for (int a = 0; a < 3; a++) {
                const double low = t->node[child].low[a], high = t->node[child].high[a];
                node->low[a] = low < node->low[a] ? low : node->low[a];
                node->high[a] = high > node->high[a] ? high : node->high[a];
            }
        }
    }
    node->skip = t->nodes;
}

/* An empty tree with room; NULL when out of memory. */
static inline dem__tree *dem__plant(const dem_allocator *a, ptrdiff_t vertices, ptrdiff_t triangles) {
    const size_t v = (size_t)vertices, k = (size_t)triangles;
    const size_t bytes = sizeof(dem__tree) + (v + k) * sizeof(dem_vec) + k * sizeof(dem__node) + 3 * k * sizeof(int32_t);
    dem__tree *t = (dem__tree *)a->fn(a->user, NULL, 0, bytes);
    if (!t) return NULL;
    memset(t, 0, bytes);
    t->bytes = bytes;
    t->vertices = (int32_t)vertices;
    t->vertex = (dem_vec *)(void *)(t + 1);
    t->normal = t->vertex + v;
    t->node = (dem__node *)(void *)(t->normal + k);
    t->corner = (int32_t *)(void *)(t->node + k);
    return t;
}

/* Twice the area, as a vector along the normal; by the two shorter edges, which keeps the figures of a sliver. */
static inline dem_vec dem__area(dem_vec a, dem_vec b, dem_vec c) {
    const dem_vec ab = dem__sub(b, a), bc = dem__sub(c, b), ca = dem__sub(a, c);
    const double x = dem__dot(ab, ab), y = dem__dot(bc, bc), z = dem__dot(ca, ca);
    if (x >= y && x >= z) return dem__cross(bc, ca);
    return y >= z ? dem__cross(ca, ab) : dem__cross(ab, bc);
}

/* Has a triangle an area that its corners' round-off has not made? Its normal becomes *unit. */
static inline int dem__has_area(dem_vec a, dem_vec b, dem_vec c, dem_vec *unit) {
    const dem_vec n = dem__area(a, b, c), ab = dem__sub(b, a), ac = dem__sub(c, a), bc = dem__sub(c, b);
    double longest = dem__dot(ab, ab);
    longest = dem__dot(ac, ac) > longest ? dem__dot(ac, ac) : longest;
    longest = dem__dot(bc, bc) > longest ? dem__dot(bc, bc) : longest;
    return dem__length(n) > 1e-9 * longest && dem__unit(n, unit);
}

/* The tree of the triangles that have an area. NULL with *status DEM_OUT_OF_MEMORY, or DEM_BAD_ARGUMENT if there is none. */
static inline dem__tree *dem__make_tree(const dem_allocator *a, ptrdiff_t vertices, const dem_vec *vertex, ptrdiff_t triangles,
                                        const int32_t *corner, dem_status *status) {
    const size_t scratch = 2 * (size_t)triangles * sizeof(dem__keyed);
    dem_vec low = vertex[0], high = vertex[0], normal;
    ptrdiff_t n = 0;
    for (ptrdiff_t v = 0; v < vertices; v++) {
        for (int c = 0; c < 3; c++) {
            double *l = dem_axis_of(&low, c), *h = dem_axis_of(&high, c), x = dem_axis(vertex[v], c);
            *l = x < *l ? x : *l;
            *h = x > *h ? x : *h;
        }
    }
    *status = DEM_OUT_OF_MEMORY;
    dem__keyed *items = (dem__keyed *)a->fn(a->user, NULL, 0, scratch);
    if (!items) return NULL;
    for (int32_t k = 0; k < (int32_t)triangles; k++) {
        const dem_vec p[3] = {vertex[corner[3 * k]], vertex[corner[3 * k + 1]], vertex[corner[3 * k + 2]]};
        if (!dem__has_area(p[0], p[1], p[2], &normal)) continue;
        items[n].index = k;
        items[n].key = 0;
        for (int c = 0; c < 3; c++) {
            const double from = dem_axis(low, c), span = dem_axis(high, c) - from;
            const double x = (dem_axis(p[0], c) + dem_axis(p[1], c) + dem_axis(p[2], c)) / 3.0 - from;
            items[n].key |= dem__interleave(span > 0.0 ? (uint64_t)(dem__clamp(x / span, 0.0, 1.0) * 2097151.0) : 0) << c;
        }
        n++;
    }
    dem__tree *t = n > 0 ? dem__plant(a, vertices, n) : NULL;
    if (n == 0) *status = DEM_BAD_ARGUMENT;
    if (t) {
        dem__sort_keyed(items, items + n, n);
        memcpy(t->vertex, vertex, (size_t)vertices * sizeof *vertex);
        for (ptrdiff_t k = 0; k < n; k++) {
            const int32_t *from = &corner[3 * items[k].index];
            memcpy(&t->corner[3 * k], from, 3 * sizeof *from);
            dem__has_area(vertex[from[0]], vertex[from[1]], vertex[from[2]], &t->normal[k]);
        }
        t->triangles = (int32_t)n;
        dem__grow_node(t, 0, (int32_t)n);
        *status = DEM_OK;
    }
    a->fn(a->user, items, scratch, 0);
    return t;
}

DEM_API int dem_add_mesh(dem_world *world, int material, const dem_mesh *mesh) {
    dem_world *w = world;
    dem_wall wall;
    memset(&wall, 0, sizeof wall);
    if (!w || !w->def.allocator.fn || !mesh || material < 0 || material >= w->def.materials || !mesh->vertex || !mesh->triangle ||
        mesh->vertices < 1 || mesh->triangles < 1 || mesh->vertices > INT32_MAX / 4 || mesh->triangles > INT32_MAX / 4)
        return -(int)DEM_BAD_ARGUMENT;
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (ptrdiff_t k = 0; k < 3 * mesh->triangles; k++) {
        if (mesh->triangle[k] < 0 || mesh->triangle[k] >= mesh->vertices) return -(int)DEM_BAD_ARGUMENT;
    }
    for (ptrdiff_t k = 0; k < 3 * mesh->vertices; k++) {
        const double x = mesh->vertex[k];
        if (!(fabs(x) < 1e50)) return -(int)DEM_BAD_ARGUMENT; /* so that squares of areas are finite */
        low[k % 3] = x < low[k % 3] ? x : low[k % 3];
        high[k % 3] = x > high[k % 3] ? x : high[k % 3];
    }
    if (w->walls >= DEM_WALLS_MAX) return -(int)DEM_TOO_MANY;
    wall.kind = DEM_MESH;
    wall.material = material;
    wall.origin = dem_vec3(0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), 0.5 * (low[2] + high[2]));
    dem__frame(&wall, dem_vec3(0, 0, 1), dem_vec3(1, 0, 0));

    const dem_allocator *a = &w->def.allocator;
    const size_t bytes = (size_t)mesh->vertices * sizeof(dem_vec);
    dem_status status = DEM_OUT_OF_MEMORY;
    dem_vec *local = (dem_vec *)a->fn(a->user, NULL, 0, bytes);
    for (ptrdiff_t k = 0; local && k < mesh->vertices; k++) {
        const double *x = &mesh->vertex[3 * k];
        local[k] = dem__sub(dem_vec3(x[0], x[1], x[2]), wall.origin);
    }
    if (local) wall.tree = dem__make_tree(a, mesh->vertices, local, mesh->triangles, mesh->triangle, &status);
    if (local) a->fn(a->user, local, bytes, 0);
    if (wall.tree && !dem__make_places(w)) {
        a->fn(a->user, wall.tree, wall.tree->bytes, 0);
        wall.tree = NULL, status = DEM_OUT_OF_MEMORY;
    }
    if (!wall.tree) return -(int)status;
    w->meshes__++;
    return dem__add_wall(w, &wall);
}

DEM_API int dem_add_box(dem_world *world, int material, dem_vec low, dem_vec high) {
    /* corner k: bit c chooses low or high of axis c */
    int32_t faces[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    double corners[24];
    dem_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    if (!(low.x < high.x && low.y < high.y && low.z < high.z)) return -(int)DEM_BAD_ARGUMENT;
    for (int k = 0; k < 24; k++) corners[k] = (k / 3 >> k % 3 & 1) ? dem_axis(high, k % 3) : dem_axis(low, k % 3);
    mesh.vertices = 8, mesh.vertex = corners;
    mesh.triangles = 12, mesh.triangle = faces;
    return dem_add_mesh(world, material, &mesh);
}

/* ---- STL ---- */

/* Open addressing: slots of 64-bit keys, each with a number; capacity is a power of two, key 0 is empty. */
typedef struct dem__slot {
    uint64_t key;
    int32_t value, forward, backward; /* edges: triangles that run along it each way */
} dem__slot;

static inline uint64_t dem__scramble(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline dem__slot *dem__find_slot(dem__slot *slots, size_t capacity, uint64_t key) {
    size_t at = (size_t)dem__scramble(key) & (capacity - 1);
    while (slots[at].key != 0 && slots[at].key != key) at = (at + 1) & (capacity - 1);
    return &slots[at];
}

/* What a facet is before welding: normal, then three corners. */
typedef struct dem__facet {
    dem_vec normal, corner[3];
} dem__facet;

static inline double dem__little_float(const unsigned char *byte) {
    const uint32_t bits = (uint32_t)byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* Binary: 80 bytes, a count, 50 bytes a facet. facets may be NULL, to count. Returns the whole ones. */
static inline ptrdiff_t dem__read_binary(const unsigned char *bytes, size_t size, dem__facet *facets, ptrdiff_t *missing) {
    const uint32_t announced = (uint32_t)bytes[80] | (uint32_t)bytes[81] << 8 | (uint32_t)bytes[82] << 16 | (uint32_t)bytes[83] << 24;
    const size_t present = (size - 84) / 50, n = present < announced ? present : announced;
    for (size_t k = 0; facets && k < n; k++) {
        for (int a = 0; a < 12; a++) {
            dem_vec *to = a < 3 ? &facets[k].normal : &facets[k].corner[a / 3 - 1];
            *dem_axis_of(to, a % 3) = dem__little_float(bytes + 84 + 50 * k + 4 * a);
        }
    }
    *missing = (ptrdiff_t)(announced - n);
    return (ptrdiff_t)n;
}

/* The next word of a text: blanks of any kind part them. Returns its length, 0 at the end. */
static inline size_t dem__word(const unsigned char *bytes, size_t size, size_t *at) {
    size_t length = 0;
    while (*at < size && bytes[*at] <= ' ') ++*at;
    while (*at + length < size && bytes[*at + length] > ' ') length++;
    return length;
}

static inline int dem__is_word(const unsigned char *bytes, size_t at, size_t length, const char *name) {
    size_t k = 0;
    for (; name[k]; k++) {
        const unsigned char c = k < length ? bytes[at + k] : 0;
        if ((c >= 'A' && c <= 'Z' ? c + 32 : c) != (unsigned char)name[k]) return 0;
    }
    return k == length;
}

/* A decimal number, free of the locale; within an ulp or two. NaN if it is none. */
static inline double dem__number(const unsigned char *text, size_t length) {
    size_t k = 0;
    int digits = 0, point = 0, exponent = 0, down = 0;
    uint64_t whole = 0; /* the first 18 digits */
    const int minus = length > 0 && text[0] == '-';
    if (length > 0 && (text[0] == '-' || text[0] == '+')) k++;
    for (; k < length && ((text[k] >= '0' && text[k] <= '9') || (text[k] == '.' && !point)); k++) {
        if (text[k] == '.') {
            point = 1;
            continue;
        }
        if (whole < 100000000000000000u) whole = 10u * whole + (uint64_t)(text[k] - '0'), exponent -= point;
        else exponent += !point;
        digits++;
    }
    if (digits && k < length && (text[k] == 'e' || text[k] == 'E')) {
        int power = 0, any = 0;
        k++;
        if (k < length && (text[k] == '-' || text[k] == '+')) down = text[k++] == '-';
        for (; k < length && text[k] >= '0' && text[k] <= '9'; k++, any = 1) power = power < 10000 ? 10 * power + (text[k] - '0') : power;
        if (!any) return (double)NAN;
        exponent += down ? -power : power;
    }
    if (!digits || k != length) return (double)NAN;
    double ten = 1.0, base = 10.0; /* exact up to 10^22 */
    if (exponent < -400 || exponent > 400) exponent = exponent < 0 ? -400 : 400;
    for (int e = exponent < 0 ? -exponent : exponent; e > 0; e >>= 1, base *= base) ten *= e & 1 ? base : 1.0;
    const double value = whole == 0 ? 0.0 : (exponent < 0 ? (double)whole / ten : (double)whole * ten);
    return minus ? -value : value;
}

/* ASCII: facets are where "facet" stands with its three vertices before the next one; whatever else there is does not matter. */
static inline ptrdiff_t dem__read_ascii(const unsigned char *bytes, size_t size, dem__facet *facets, ptrdiff_t *missing) {
    ptrdiff_t n = 0, begun = 0;
    dem__facet facet;
    int corners = 3, wanted = 0; /* numbers of the present triple still to come */
    dem_vec *to = NULL;
    memset(&facet, 0, sizeof facet);
    for (size_t at = 0, length; (length = dem__word(bytes, size, &at)) > 0; at += length) {
        if (dem__is_word(bytes, at, length, "facet")) {
            begun++;
            corners = 0, wanted = 0;
            facet.normal = dem_vec3(0.0, 0.0, 0.0);
        } else if (dem__is_word(bytes, at, length, "normal")) {
            wanted = 3, to = &facet.normal;
        } else if (dem__is_word(bytes, at, length, "vertex") && corners < 3) {
            wanted = 3, to = &facet.corner[corners];
        } else if (wanted > 0) {
            *dem_axis_of(to, 3 - wanted) = dem__number(bytes + at, length);
            if (--wanted > 0 || to == &facet.normal) continue;
            if (++corners < 3) continue;
            if (facets) facets[n] = facet;
            n++;
        }
    }
    *missing = begun > n ? begun - n : 0;
    return n;
}

/* Many binary files begin with "solid" too: the size decides, then whether there is a facet in the text. */
static inline int dem__is_binary(const unsigned char *bytes, size_t size) {
    ptrdiff_t missing;
    size_t at = 0;
    if (size < 84) return 0;
    dem__read_binary(bytes, size, NULL, &missing);
    if (missing == 0 && (size - 84) / 50 > 0) {
        const uint32_t n = (uint32_t)bytes[80] | (uint32_t)bytes[81] << 8 | (uint32_t)bytes[82] << 16 | (uint32_t)bytes[83] << 24;
        if (size == 84 + 50 * (size_t)n) return 1;
    }
    if (!dem__is_word(bytes, at, dem__word(bytes, size, &at), "solid")) return 1;
    return dem__read_ascii(bytes, size, NULL, &missing) == 0;
}

/* The vertex at a place, an earlier one if that is within `weld`. Vertices hang in chains from the cells of a grid. */
static inline int32_t dem__weld(dem__slot *cells, size_t capacity, int32_t *next, dem_vec *vertex, ptrdiff_t *count, dem_vec p, dem_vec low,
                                double weld, double cell) {
    double from[3], to[3];
    for (int a = 0; a < 3; a++) {
        const double x = dem_axis(p, a) - dem_axis(low, a);
        from[a] = floor((x - weld) / cell), to[a] = floor((x + weld) / cell);
    }
    for (double i = from[0]; i <= to[0]; i++) {
        for (double j = from[1]; j <= to[1]; j++) {
            for (double k = from[2]; k <= to[2]; k++) {
                const uint64_t key = dem__interleave((uint64_t)(i + 2.0)) | dem__interleave((uint64_t)(j + 2.0)) << 1 |
                                     dem__interleave((uint64_t)(k + 2.0)) << 2;
                const dem__slot *slot = dem__find_slot(cells, capacity, key);
                for (int32_t v = slot->key ? slot->value : -1; v >= 0; v = next[v]) {
                    if (dem__length(dem__sub(vertex[v], p)) <= weld) return v;
                }
            }
        }
    }
    const int32_t fresh = (int32_t)(*count)++;
    uint64_t key = 0;
    for (int a = 0; a < 3; a++) key |= dem__interleave((uint64_t)(floor((dem_axis(p, a) - dem_axis(low, a)) / cell) + 2.0)) << a;
    dem__slot *slot = dem__find_slot(cells, capacity, key);
    vertex[fresh] = p;
    next[fresh] = slot->key ? slot->value : -1;
    slot->key = key;
    slot->value = fresh;
    return fresh;
}

/* Edge (a, b) of a triangle. */
static inline void dem__count_edge(dem__slot *edges, size_t capacity, int32_t a, int32_t b) {
    const uint64_t low = (uint64_t)(a < b ? a : b), high = (uint64_t)(a < b ? b : a);
    dem__slot *slot = dem__find_slot(edges, capacity, low << 32 | high);
    slot->key = low << 32 | high; /* never 0, as a < b */
    if (a < b) slot->forward++;
    else slot->backward++;
}

/* Fills an empty mesh, whose arrays have room, from n facets, and the report. slots has room for `capacity` slots, next for 3 n. */
static inline void dem__make_mesh(dem_mesh *m, dem__facet *facets, ptrdiff_t n, double scale, double weld, dem__slot *slots,
                                  size_t capacity, int32_t *next, dem_stl_report *report) {
    dem_vec *vertex = (dem_vec *)(void *)m->vertex, low = dem_vec3(HUGE_VAL, HUGE_VAL, HUGE_VAL), high = dem__scale(-1.0, low);
    ptrdiff_t kept = 0;
    for (ptrdiff_t k = 0; k < n; k++) {
        int finite = 1;
        for (int c = 0; c < 9; c++) {
            double *x = dem_axis_of(&facets[k].corner[c / 3], c % 3);
            *x *= scale;
            finite &= fabs(*x) < 1e50;
        }
        if (!finite) {
            report->not_finite++;
            continue;
        }
        facets[kept++] = facets[k];
        for (int c = 0; c < 9; c++) {
            double *l = dem_axis_of(&low, c % 3), *h = dem_axis_of(&high, c % 3), x = dem_axis(facets[k].corner[c / 3], c % 3);
            *l = x < *l ? x : *l;
            *h = x > *h ? x : *h;
        }
    }
    if (kept == 0) return;
    /* cells: some times the welding distance, and few enough to be numbered by 21 bits an axis */
    const double size = dem__length(dem__sub(high, low)), least = size / 1048576.0;
    weld = weld < size ? weld : size;
    const double cell = 4.0 * weld > least ? 4.0 * weld : (least > 0.0 ? least : 1.0);
    for (ptrdiff_t k = 0; k < kept; k++) {
        int32_t *to = &m->triangle[3 * k];
        for (int c = 0; c < 3; c++) to[c] = dem__weld(slots, capacity, next, vertex, &m->vertices, facets[k].corner[c], low, weld, cell);
    }
    report->low = low, report->high = high;
    memset(slots, 0, capacity * sizeof *slots);
    for (ptrdiff_t k = 0; k < kept; k++) {
        const int32_t t[3] = {m->triangle[3 * k], m->triangle[3 * k + 1], m->triangle[3 * k + 2]};
        dem_vec normal;
        const dem_vec a = vertex[t[0]], b = vertex[t[1]], c = vertex[t[2]];
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0] || !dem__has_area(a, b, c, &normal)) {
            report->degenerate++;
            continue;
        }
        const int32_t first = t[0] < t[1] ? (t[0] < t[2] ? t[0] : t[2]) : (t[1] < t[2] ? t[1] : t[2]);
        const int32_t last = t[0] > t[1] ? (t[0] > t[2] ? t[0] : t[2]) : (t[1] > t[2] ? t[1] : t[2]);
        const uint64_t middle = (uint64_t)t[0] + (uint64_t)t[1] + (uint64_t)t[2] - (uint64_t)first - (uint64_t)last;
        /* three numbers to a key that others share only by a chance of 2^-64 a pair */
        const uint64_t key = dem__scramble(dem__scramble((uint64_t)first + 1) + dem__scramble(middle + 1) * 3 + (uint64_t)last) | 1;
        dem__slot *slot = dem__find_slot(slots, capacity, key);
        if (slot->key) {
            report->duplicate++;
            continue;
        }
        slot->key = key;
        const dem_vec twice = dem__area(a, b, c), given = facets[k].normal;
        const double length = dem__length(given);
        if (dem__positive(length) && dem__dot(given, normal) < 0.5 * length) report->wrong_normals++;
        report->area += 0.5 * dem__length(twice);
        report->volume += dem__dot(dem__sub(a, low), twice) / 6.0;
        memcpy(&m->triangle[3 * m->triangles++], t, sizeof t);
    }
    memset(slots, 0, capacity * sizeof *slots);
    for (ptrdiff_t k = 0; k < 3 * m->triangles; k++)
        dem__count_edge(slots, capacity, m->triangle[k], m->triangle[k % 3 == 2 ? k - 2 : k + 1]);
    for (size_t k = 0; k < capacity; k++) {
        const int32_t f = slots[k].forward, b = slots[k].backward;
        report->open_edges += f + b == 1;
        report->nonmanifold += f + b > 2;
        report->inconsistent += f + b == 2 && f != b;
    }
}

DEM_API dem_status dem_read_stl(const void *bytes, size_t size, double scale, double weld, const dem_allocator *allocator, dem_mesh *mesh,
                                dem_stl_report *report) {
    const unsigned char *text = (const unsigned char *)bytes;
    dem_stl_report found;
    dem_allocator memory;
    if (!mesh) return DEM_BAD_ARGUMENT;
    memset(mesh, 0, sizeof *mesh);
    memset(&found, 0, sizeof found);
    if (report) *report = found;
    if ((size > 0 && !bytes) || !dem__positive(scale) || !dem__not_negative(weld)) return DEM_BAD_ARGUMENT;
    memory.fn = dem__default_allocator;
    memory.user = NULL;
    if (allocator) memory = *allocator;

    found.binary = dem__is_binary(text, size);
    found.facets = found.binary ? dem__read_binary(text, size, NULL, &found.missing) : dem__read_ascii(text, size, NULL, &found.missing);
    if (report) *report = found;
    if (found.facets == 0) return DEM_BAD_DATA;
    if (found.facets > INT32_MAX / 12) return DEM_TOO_MANY;
    const size_t n = (size_t)found.facets;
    size_t capacity = 64;
    while (capacity < 6 * n) capacity *= 2;
    const size_t scratch = n * sizeof(dem__facet) + capacity * sizeof(dem__slot) + 3 * n * sizeof(int32_t);
    mesh->bytes = 3 * n * sizeof(dem_vec) + 3 * n * sizeof(int32_t);
    mesh->allocator = memory;
    mesh->block = memory.fn(memory.user, NULL, 0, mesh->bytes);
    dem__facet *facets = mesh->block ? (dem__facet *)memory.fn(memory.user, NULL, 0, scratch) : NULL;
    if (!facets) {
        dem_free_mesh(mesh);
        return DEM_OUT_OF_MEMORY;
    }
    dem__slot *slots = (dem__slot *)(void *)(facets + n);
    int32_t *next = (int32_t *)(void *)(slots + capacity);
    memset(slots, 0, capacity * sizeof *slots);
    mesh->vertex = (double *)mesh->block;
    mesh->triangle = (int32_t *)(void *)(mesh->vertex + 9 * n);
    if (found.binary) dem__read_binary(text, size, facets, &found.missing);
    else dem__read_ascii(text, size, facets, &found.missing);
    dem__make_mesh(mesh, facets, found.facets, scale, weld, slots, capacity, next, &found);
    memory.fn(memory.user, facets, scratch, 0);
    if (report) *report = found;
    if (mesh->triangles > 0) return DEM_OK;
    dem_free_mesh(mesh);
    return DEM_BAD_DATA;
}

DEM_API void dem_free_mesh(dem_mesh *mesh) {
    if (!mesh) return;
    if (mesh->block) mesh->allocator.fn(mesh->allocator.user, mesh->block, mesh->bytes, 0);
    memset(mesh, 0, sizeof *mesh);
}

/* A new motion begins where the wall is. */
static inline dem_wall *dem__rebase_wall(dem_world *w, int wall) {
    if (!w || wall < 0 || wall >= w->walls) return NULL;
    dem_wall *a = &w->wall[wall];
    dem__move_wall(a, w->time);
    a->origin = a->position;
    for (int k = 0; k < 3; k++) a->rest_axis[k] = a->axis[k];
    a->spin_centre = dem__add(a->spin_centre, dem__scale(w->time - a->motion_start, a->drift));
    a->motion_start = w->time;
    if (a->drive != DEM_KINEMATIC) a->spin = a->spin_rate = a->spin_bound = 0.0; /* a drive moves the wall alone */
    a->drive = DEM_KINEMATIC;
    w->stale__ = 1;
    return a;
}

static inline void dem__bound_speed(dem_wall *a) {
    double rate = 2.0 * RIDDLE_PI * a->frequency;
    const dem_vec n = a->axis[2];
    const double x = fabs(a->amplitude.x), y = fabs(a->amplitude.y), z = fabs(a->amplitude.z);
    a->speed_bound = rate * (x + y + z) + dem__length(a->drift);
    a->acceleration_bound = rate * rate * (x + y + z);
    a->side_bound = rate * rate * (x * sqrt(fabs(1.0 - n.x * n.x)) + y * sqrt(fabs(1.0 - n.y * n.y)) + z * sqrt(fabs(1.0 - n.z * n.z)));
    a->spin_bound = fabs(a->spin);
    a->slides = a->spin != 0.0 || a->belt.x != 0.0 || a->belt.y != 0.0 || a->belt.z != 0.0;
}

DEM_API dem_status dem_vibrate(dem_world *world, int wall, dem_vec amplitude, dem_vec phase, double frequency) {
    if (!world || wall < 0 || wall >= world->walls || !dem__finite_vec(amplitude) || !dem__finite_vec(phase) ||
        !dem__not_negative(frequency))
        return DEM_BAD_ARGUMENT;
    if (!(fabs(phase.x) < 1e3 && fabs(phase.y) < 1e3 && fabs(phase.z) < 1e3)) return DEM_BAD_ARGUMENT;
    dem_wall *a = dem__rebase_wall(world, wall);
    a->amplitude = amplitude;
    a->phase = phase;
    a->frequency = frequency;
    dem__bound_speed(a);
    return DEM_OK;
}

DEM_API dem_status dem_move(dem_world *world, int wall, dem_vec velocity) {
    if (!world || wall < 0 || wall >= world->walls || !dem__finite_vec(velocity)) return DEM_BAD_ARGUMENT;
    dem_wall *a = dem__rebase_wall(world, wall);
    a->drift = velocity;
    dem__bound_speed(a);
    return DEM_OK;
}

DEM_API dem_status dem_rotate(dem_world *world, int wall, dem_vec centre, dem_vec axis, double spin) {
    dem_vec unit;
    if (!world || wall < 0 || wall >= world->walls || !dem__finite_vec(centre) || !dem__finite_vec(axis) || !dem__finite(spin) ||
        !dem__unit(axis, &unit))
        return DEM_BAD_ARGUMENT;
    dem_wall *a = dem__rebase_wall(world, wall);
    a->spin_centre = centre;
    a->spin_axis = unit;
    a->spin = spin;
    dem__bound_speed(a);
    return DEM_OK;
}

/* From now on the wall moves by a drive alone. */
static inline dem_wall *dem__drive(dem_world *w, int wall, dem_drive drive) {
    dem_wall *a = dem__rebase_wall(w, wall);
    a->amplitude = a->drift = dem_vec3(0.0, 0.0, 0.0);
    a->spin = a->spin_rate = a->coordinate = a->rate = a->rate_change = 0.0;
    a->speed_bound = a->spin_bound = 0.0; /* the first step finds them */
    a->slides = 1;
    a->drive = (int)drive;
    w->fresh__ = 1; /* its acceleration is to be found */
    return a;
}

static inline int dem__wall_is_finite(const dem_wall *a) {
    return dem__finite_vec(a->position) && dem__finite_vec(a->velocity) && dem__finite_vec(a->acceleration) && dem__finite(a->spin) &&
           dem__finite_vec(a->axis[0]) && dem__finite_vec(a->axis[1]) && dem__finite_vec(a->axis[2]);
}

DEM_API dem_status dem_prescribe(dem_world *world, int wall, dem_vec centre, dem_motion_fn motion, void *user) {
    if (!world || wall < 0 || wall >= world->walls || !motion || !dem__finite_vec(centre)) return DEM_BAD_ARGUMENT;
    dem_wall *a = &world->wall[wall], before = *a, probe = *a;
    if (a->drive != DEM_PRESCRIBED) probe.origin = a->position, memcpy(probe.rest_axis, a->axis, sizeof a->axis);
    probe.drive = DEM_PRESCRIBED;
    probe.spin_centre = centre;
    probe.motion = motion, probe.motion_user = user;
    probe.interval = world->dt__;
    dem__move_wall(&probe, world->time);
    if (!dem__wall_is_finite(&probe)) return DEM_BAD_ARGUMENT;
    if (before.drive != DEM_PRESCRIBED) a = dem__drive(world, wall, DEM_PRESCRIBED), a->interval = world->dt__;
    a->spin_centre = centre;
    a->motion = motion, a->motion_user = user;
    world->stale__ = 1; /* another function may put it elsewhere */
    return DEM_OK;
}

static inline dem_status dem__control(dem_world *w, int wall, dem_drive drive, dem_vec centre, dem_vec axis, double inertia, double load,
                                      double damping) {
    dem_vec unit;
    if (!w || wall < 0 || wall >= w->walls || !dem__finite_vec(centre) || !dem__finite_vec(axis) || !dem__unit(axis, &unit) ||
        !dem__positive(inertia) || !dem__finite(load) || !dem__not_negative(damping))
        return DEM_BAD_ARGUMENT;
    dem__move_wall(&w->wall[wall], w->time);
    const dem_vec spin = dem__scale(w->wall[wall].spin, w->wall[wall].spin_axis);
    const double rate = dem__dot(drive == DEM_FORCE_CONTROLLED ? w->wall[wall].velocity : spin, unit);
    dem_wall *a = dem__drive(w, wall, drive);
    a->spin_centre = centre;
    a->spin_axis = unit;
    a->inertia = inertia;
    a->load = load;
    a->damping = damping;
    a->rate = rate;
    w->controls__ = 1;
    return DEM_OK;
}

DEM_API dem_status dem_control_force(dem_world *world, int wall, dem_vec axis, double mass, double force, double damping) {
    return dem__control(world, wall, DEM_FORCE_CONTROLLED, dem_vec3(0, 0, 0), axis, mass, force, damping);
}
DEM_API dem_status dem_control_torque(dem_world *world, int wall, dem_vec centre, dem_vec axis, double inertia, double torque,
                                      double damping) {
    return dem__control(world, wall, DEM_TORQUE_CONTROLLED, centre, axis, inertia, torque, damping);
}

DEM_API dem_status dem_set_belt(dem_world *world, int wall, dem_vec velocity) {
    if (!world || wall < 0 || wall >= world->walls || !dem__finite_vec(velocity)) return DEM_BAD_ARGUMENT;
    world->wall[wall].belt = velocity;
    world->wall[wall].slides = 1;
    return DEM_OK;
}

/* A controlled wall's acceleration from the forces on it, and its rate corrected from predicted to final; the damper implicit. */
static inline void dem__kick_walls(dem_world *w, double h) {
    for (int k = 0; k < w->walls && w->controls__; k++) {
        dem_wall *a = &w->wall[k];
        if (a->drive < DEM_FORCE_CONTROLLED) continue;
        const dem_vec torque = dem__add(a->torque, dem__cross(dem__sub(a->position, a->spin_centre), a->force));
        const double push = a->load + dem__dot(a->drive == DEM_FORCE_CONTROLLED ? a->force : torque, a->spin_axis), half = 0.5 * h;
        const double rate = (a->rate + half * (a->rate_change + push / a->inertia)) / (1.0 + half * a->damping / a->inertia);
        a->coordinate += h * (a->rate + half * a->rate_change);
        a->rate = rate;
        a->rate_change = (push - a->damping * rate) / a->inertia;
        a->motion_start = h > 0.0 ? w->start_time__ + (double)(w->step + 1 - w->start_step__) * w->dt__ : w->time;
        dem__rated_wall(a, a->rate);
    }
}

/* An impulse on a wall at a sphere's place, with an angular impulse, beside the forces of the step. */
static inline void dem__strike_wall(dem_wall *a, dem_vec place, dem_vec impulse, dem_vec angular) {
    a->impulse = dem__add(a->impulse, impulse);
    if (a->drive < DEM_FORCE_CONTROLLED) return;
    const dem_vec turning = dem__add(angular, dem__cross(dem__sub(place, a->spin_centre), impulse));
    a->rate += dem__dot(a->drive == DEM_FORCE_CONTROLLED ? impulse : turning, a->spin_axis) / a->inertia;
    dem__rated_wall(a, a->rate);
}

DEM_API dem_status dem_enable_wall(dem_world *world, int wall, int enabled) {
    if (!world || wall < 0 || wall >= world->walls) return DEM_BAD_ARGUMENT;
    world->wall[wall].enabled = enabled != 0;
    world->stale__ = world->fresh__ = 1;
    return DEM_OK;
}

/* ------------------------------------------------------------------------------------------------- >>lists */

/* So many parts are n pieces of work shared in: one, or one a thread if each is worth starting it. One part begins no parallel region, for
   that would cost more than the work of a dilute step. */
DEM_INLINE int dem__parts(const dem_world *w, ptrdiff_t n) {
#ifdef _OPENMP
    return w->def.threads == 1 || n < 256 * (ptrdiff_t)w->def.threads ? 1
           : w->def.threads < DEM__PARTS_MAX                          ? w->def.threads
                                                                      : DEM__PARTS_MAX;
#else
    (void)w, (void)n;
    return 1;
#endif
}
DEM_INLINE ptrdiff_t dem__part(ptrdiff_t n, int part, int parts) { return n / parts * part + (n % parts < part ? n % parts : part); }

/* The same if there are only `most` things to share. */
DEM_INLINE int dem__parts_of(const dem_world *w, ptrdiff_t n, int most) {
    const int parts = dem__parts(w, n);
    return parts < most ? parts : most;
}

/* A timer is of a near pair, or of a particle and a wall. A look finds a contact, or the next time when one is possible. */

DEM_INLINE void dem__set_due(dem__timers *t, int32_t e, int32_t due) {
    int32_t *earliest = &t->earliest[(uint32_t)e / DEM__BUNCH];
    t->due[e] = due;
    *earliest = due < *earliest ? due : *earliest;
}
DEM_INLINE void dem__set_timer(dem__timers *t, int32_t e, int64_t step) { dem__set_due(t, e, (int32_t)(step - t->from)); }
DEM_INLINE void dem__stop_timer(dem__timers *t, int32_t e) { t->due[e] = DEM__STOPPED; }

DEM_INLINE int32_t dem__earliest(const int32_t *due) {
    int32_t earliest = DEM__STOPPED;
    DEM__ROLLED
    for (int k = 0; k < DEM__BUNCH; k++) earliest = due[k] < earliest ? due[k] : earliest;
    return earliest;
}

/* Those of bunch b that are due go to the end of a list of n, and are set to `then`; how many are listed. */
DEM_INLINE ptrdiff_t dem__open_bunch(dem__timers *t, ptrdiff_t b, int32_t now, int32_t then, int32_t *list, ptrdiff_t n) {
    int32_t *due = t->due + b * DEM__BUNCH;
    t->earliest[b] = dem__earliest(due);
    if (t->earliest[b] > now) return n; /* those it was have been set anew */
    for (int k = 0; k < DEM__BUNCH; k++) {
        list[n] = (int32_t)(b * DEM__BUNCH) + k;
        n += due[k] <= now;
    }
    DEM__ROLLED
    for (int k = 0; k < DEM__BUNCH; k++) due[k] = due[k] <= now ? then : due[k];
    t->earliest[b] = dem__earliest(due);
    return n;
}

/* Lists the timers in sheaves first .. end-1 that are due at a step, from list[first * DEM__SHEAF] on, and sets them to `then`; how
   many. */
DEM_INLINE ptrdiff_t dem__find_due(dem__timers *t, ptrdiff_t first, ptrdiff_t end, int64_t step, int32_t then) {
    const int32_t now = (int32_t)(step - t->from);
    int32_t *list = t->list + first * DEM__SHEAF;
    ptrdiff_t n = 0;
    int32_t open[4 * DEM__BUNCH];
    int opened = 0;
    for (ptrdiff_t s = first; s < end; s++) {
        const int32_t *earliest = &t->earliest[s * DEM__BUNCH];
        int any = 0;
        DEM__ROLLED
        for (int k = 0; k < DEM__BUNCH; k++) any |= earliest[k] <= now;
        const int before = opened;
        for (int k = 0; k < DEM__BUNCH && any; k++) { /* without a branch, which nobody could predict */
            open[opened] = (int32_t)(s * DEM__BUNCH) + k;
            opened += earliest[k] <= now;
        }
        for (int k = before; k < opened; k++) DEM__PREFETCH(&t->due[open[k] * DEM__BUNCH]);
        if (opened <= 3 * DEM__BUNCH && s + 1 < end) continue;
        for (int k = 0; k < opened; k++) n = dem__open_bunch(t, open[k], now, then, list, n);
        opened = 0;
    }
    return n;
}
DEM__TWICE(dem__list_due, (dem__timers * t, ptrdiff_t first, ptrdiff_t end, int64_t step, int32_t then, ptrdiff_t *n),
           (t, first, end, step, then, n), *n = dem__find_due(t, first, end, step, then))

/* From a step on: until the timer is due, and for how long nothing can happen at a wall, which may be longer. */
DEM_INLINE int dem__steps_due(const dem__timers *t, int32_t e, int64_t step) { return (int)(t->due[e] - (step - t->from)); }
DEM_INLINE int dem__steps_sure(const dem_world *w, int32_t e, int64_t step) {
    return (int)(int32_t)(w->wall_sure__[e] - (uint32_t)(uint64_t)step);
}

/* Steps until t [s], at least one, at most DEM__FAR - 1: no contact can happen before. */
DEM_INLINE int dem__steps_until(const dem_world *w, double t) {
    double n = t * w->pace__;
    return n < (double)(DEM__FAR - 2) ? 1 + (int)n : DEM__FAR - 1;
}

/* Time in which something at speed s, falling besides with g, covers a distance. */
DEM_INLINE double dem__time_to_cover(double distance, double s, double g) {
    return distance > 0.0 ? 2.0 * distance / (s + sqrt(s * s + 2.0 * g * distance)) : 0.0;
}

/* Time in which something covers a distance that approaches at u (< 0: recedes) and accelerates by at most a. */
DEM_INLINE double dem__time_to_close(double distance, double u, double a) {
    const double root = u + sqrt(u * u + 2.0 * a * distance);
    return distance > 0.0 ? (root > 0.0 ? 2.0 * distance / root : HUGE_VAL) : 0.0;
}

/* From the centre of j to that of i, at a step. */
DEM_INLINE dem_vec dem__pair_apart(const dem_world *w, ptrdiff_t i, ptrdiff_t j, int64_t step) {
    return dem__apart(w, dem__sub(dem__at(w, i, (double)(step - w->particle[i].origin) * w->dt__),
                                  dem__at(w, j, (double)(step - w->particle[j].origin) * w->dt__)));
}

typedef double dem__row[DEM_BLOCK];

/* Pairs whose timers are to be set; and what looks have found. */
typedef struct dem__waits {
    dem__course apart[DEM_BLOCK]; /* of one relative to the other: they touch within `off` */
    int32_t pair[DEM_BLOCK], steps[DEM_BLOCK];
    int n;
    int32_t *found; /* of a look: pairs that touch */
    ptrdiff_t touch;
    int64_t looks;
} dem__waits;

DEM_INLINE void dem__no_waits(dem__waits *q) { q->n = 0, q->found = NULL, q->touch = 0, q->looks = 0; }

/* Steps until spheres can touch that stray so far from their courses: 0 for never, else at least one, at most DEM__FAR - 1. */
DEM_INLINE void dem__wait_steps(dem__waits *q, double pace) {
    for (int k = 0; k < q->n; k++) {
        const dem__course *r = &q->apart[k];
        const double a = r->ux * r->ux + r->uy * r->uy + r->uz * r->uz - r->ball * r->ball;
        const double b = r->x * r->ux + r->y * r->uy + r->z * r->uz - r->off * r->ball;
        const double c = r->x * r->x + r->y * r->y + r->z * r->z - r->off * r->off;
        const double root = b * b - a * c, below = sqrt(root > 0.0 ? root : 0.0) - b;
        const double n = c / (below > 0.0 ? below : 1.0) * pace, turns = n < (double)(DEM__FAR - 2) ? n : (double)(DEM__FAR - 2);
        const double steps = ((root > 0.0) & (below > 0.0)) ? 1.0 + turns : 0.0;
        q->steps[k] = (int32_t)(c > 0.0 ? steps : 1.0);
    }
}
DEM__TWICE(dem__find_steps, (dem__waits * q, double pace), (q, pace), dem__wait_steps(q, pace))

static inline void dem__set_waits(dem_world *w, dem__waits *q, int64_t step) {
    const int32_t now = (int32_t)(step - w->pair_timers__.from);
    dem__find_steps(q, w->pace__);
    for (int k = 0; k < q->n; k++) dem__set_due(&w->pair_timers__, q->pair[k], q->steps[k] > 0 ? now + q->steps[k] : DEM__NEVER);
    q->n = 0;
}

/* Time on the courses [s]. */
DEM_INLINE double dem__since_listed(const dem_world *w, int64_t step) { return (double)(step - w->listed__) * w->dt__; }

/* Where a course has led by t [s]. */
DEM_INLINE dem__course dem__course_at(const dem__course *c, double t) {
    dem__course now = *c;
    now.x += t * c->ux, now.y += t * c->uy, now.z += t * c->uz, now.off += t * c->ball;
    return now;
}

/* A place for pair p and two courses, one relative to the other. */
DEM_INLINE dem__course *dem__wait_for_pair(dem_world *w, dem__waits *q, int32_t p, int64_t step, const dem__course *a,
                                           const dem__course *b) {
    if (q->n == DEM_BLOCK) dem__set_waits(w, q, step);
    dem__course *r = &q->apart[q->n];
    q->pair[q->n++] = p;
    r->x = a->x - b->x, r->y = a->y - b->y, r->z = a->z - b->z, r->off = a->off + b->off;
    r->ux = a->ux - b->ux, r->uy = a->uy - b->uy, r->uz = a->uz - b->uz, r->ball = a->ball + b->ball;
    return r;
}

/* Pair p, linked or not, by where its courses have led at a step. */
DEM_INLINE void dem__wait_on_courses(dem_world *w, dem__waits *q, int32_t p, int64_t step, const dem__course *a, const dem__course *b) {
    dem__course *r = dem__wait_for_pair(w, q, p, step, a, b);
    if (!w->has_periodic__) return;
    const dem_vec d = dem__apart(w, dem_vec3(r->x, r->y, r->z));
    r->x = d.x, r->y = d.y, r->z = d.z;
}

/* Pair p, whose centres are known to be d apart at a step. */
DEM_INLINE void dem__wait_from(dem_world *w, dem__waits *q, int32_t p, int64_t step, dem_vec d) {
    const dem__near *pair = &w->near__[p];
    dem__course *r = dem__wait_for_pair(w, q, p, step, &w->course__[pair->i], &w->course__[pair->j]);
    r->x = d.x, r->y = d.y, r->z = d.z, r->off = pair->distance + 2.0 * w->blur__;
}

/* Every contact: DEM__EACH(w, c) { .. slot c .. }; break leaves a section only. */
#define DEM__EACH(w, c)                                                                                                                    \
    for (const dem__section *in_##c = (w)->section__; in_##c < (w)->section__ + (w)->sections__; in_##c++)                                 \
        for (ptrdiff_t c = in_##c->first; c < in_##c->first + in_##c->live; c++)

/* Contacts are numbered from 0 for others, in the order of slots: the slot of contact k, the number of that in a slot. */
DEM_INLINE ptrdiff_t dem__slot_of(const dem_world *w, ptrdiff_t k) {
    const dem__section *in = w->section__;
    while (k >= in->live) k -= in++->live;
    return in->first + k;
}
DEM_INLINE int32_t dem__number_of(const dem_world *w, ptrdiff_t c) {
    const dem__section *in = w->section__;
    ptrdiff_t before = 0;
    while (c >= in->first + in->live) before += in++->live;
    return (int32_t)(before + c - in->first);
}

/* Where the next contact is born. */
DEM_INLINE ptrdiff_t dem__next_slot(const dem_world *w) {
    const dem__section *last = &w->section__[w->sections__ - 1];
    return last->first + last->live;
}

static inline int dem__grow_live(dem_world *w, ptrdiff_t slots) {
    dem__array list[DEM__ARRAYS_MAX];
    return slots <= w->live_capacity__ || (slots <= INT32_MAX / 2 && dem__grow_group(w, list, dem__live_arrays(w, list), &w->live_block__,
                                                                                     &w->live_bytes__, &w->live_capacity__, slots));
}

/* A new contact, in the next slot; made ready in dem__admit_born. */
static inline int dem__bear(dem_world *w, ptrdiff_t i, ptrdiff_t j, int32_t element, int32_t near_pair) {
    const ptrdiff_t c = dem__next_slot(w);
    if (!dem__grow_live(w, c + 1)) {
        w->status = DEM_OUT_OF_MEMORY;
        return 0;
    }
    w->live_count__++;
    w->section__[w->sections__ - 1].live++;
    w->live_i__[c] = (int32_t)i;
    w->live_j__[c] = (int32_t)j;
    w->live_element__[c] = element;
    w->live_near__[c] = near_pair;
    w->born__++;
    return 1;
}

/* Looks at a pair: it is found, or its timer is to be set. */
static inline void dem__look_at_pair(dem_world *w, dem__waits *waits, int32_t p, int64_t step) {
    const dem__near *q = &w->near__[p];
    const dem_vec d = dem__pair_apart(w, q->i, q->j, step);
    waits->looks++;
    if (dem__dot(d, d) < q->distance * q->distance) waits->found[waits->touch++] = p;
    else if (w->def.skip & DEM_SKIP_PAIRS) dem__wait_from(w, waits, p, step, d);
}

/* Makes contacts of what looks have found. Room for many is made at once. */
static inline void dem__bear_found(dem_world *w, const dem__waits *waits) {
    const ptrdiff_t slots = dem__next_slot(w) + waits->touch;
    w->looks += waits->looks;
    if (!dem__grow_live(w, slots > w->live_capacity__ ? slots + slots / 2 : slots)) w->status = DEM_OUT_OF_MEMORY;
    for (const int32_t *p = waits->found; p < waits->found + waits->touch && w->status == DEM_OK; p++) {
        if (dem__bear(w, w->near__[*p].i, w->near__[*p].j, 0, *p)) dem__stop_timer(&w->pair_timers__, *p);
    }
}

static inline int dem__touches_element(const dem_world *w, ptrdiff_t i, int wall, int32_t element) {
    for (int32_t c = w->wall_head__[i]; c >= 0; c = w->live_wall_next__[c]) {
        if (w->live_j__[c] == -1 - wall && w->live_element__[c] == element) return 1;
    }
    return 0;
}

/* After link k in particle i's list; -1 at its end. */
DEM_INLINE int32_t dem__next_link(const dem_world *w, int32_t k, ptrdiff_t i) {
    return w->link_i__[k] == i ? w->link_next_i__[k] : w->link_next_j__[k];
}

/* The link of particle i with body j (a wall: -1 - index) at an element of it, or -1. */
static inline int32_t dem__link_of(const dem_world *w, ptrdiff_t i, ptrdiff_t j, int32_t element) {
    int32_t k = w->link_head__[i];
    while (k >= 0) {
        const int first = w->link_i__[k] == i;
        if ((first ? w->link_j__[k] : w->link_i__[k]) == j && (j >= 0 || w->link_element__[k] == element)) return k;
        k = dem__next_link(w, k, i);
    }
    return -1;
}

/* No point of a wall at x is faster than speed_bound + spin_bound times this. */
DEM_INLINE double dem__arm(const dem_wall *wall, dem_vec x) {
    const double arm = dem__length(dem__sub(x, wall->position)); /* a kinematic wall's origin turns as well, beside its speed bound */
    return wall->drive == DEM_KINEMATIC ? arm + dem__length(dem__sub(wall->origin, wall->spin_centre)) : arm;
}

/* Is there anything to look for between particle i and a wall? Of a screen another bar; of the others not while they touch: a wall has no
   second place, and what else a mesh has is found by dem__follow. */
DEM_INLINE int dem__awaits(const dem_world *w, ptrdiff_t i, int wall) {
    if (w->wall[wall].kind == DEM_SCREEN) return 1;
    for (int32_t c = w->wall_head__[i]; c >= 0; c = w->live_wall_next__[c]) {
        if (w->live_j__[c] == -1 - wall) return 0;
    }
    return 1;
}

/* A contact with a place of a wall. That of a cone, which is touched from both sides and at its rims, keeps the curvature of its
   beginning. */
static inline int dem__bear_at_wall(dem_world *w, ptrdiff_t i, int wall, const dem__touch *touch, int32_t element) {
    if (!dem__bear(w, i, -1 - wall, element, -1)) return 0;
    const ptrdiff_t c = dem__next_slot(w) - 1;
    if (w->wall[wall].kind == DEM_CONE) w->live_place__[0][c] = touch->curvature;
    if (w->wall[wall].kind != DEM_MESH) return 1;
    w->live_place__[0][c] = touch->normal.x, w->live_place__[1][c] = touch->normal.y, w->live_place__[2][c] = touch->normal.z;
    w->live_place__[3][c] = touch->gap;
    return 1;
}

/* The contacts of particle i with wall k, by element; how many. */
DEM_INLINE int dem__contacts_at(const dem_world *w, ptrdiff_t i, int k, int32_t *slot) {
    int n = 0;
    for (int32_t c = w->wall_head__[i]; c >= 0 && n < DEM__NUMBERS; c = w->live_wall_next__[c]) {
        if (w->live_j__[c] != -1 - k) continue;
        int q = n++;
        for (; q > 0 && w->live_element__[slot[q - 1]] > w->live_element__[c]; q--) slot[q] = slot[q - 1];
        slot[q] = c;
    }
    return n;
}

/* The contacts of particle i with mesh k to a step at which the wall already is: each goes on at the deepest place whose normal is near
   its own, or ends. Are there places left for new ones? */
static inline int dem__follow_mesh(dem_world *w, ptrdiff_t i, int k, const int32_t *slot, int slots, int64_t step, int bear) {
    const dem_wall *wall = &w->wall[k];
    const double tau = (double)(step - w->particle[i].origin) * w->dt__;
    const dem_vec x = dem__at(w, i, tau), d = dem__sub(x, wall->position);
    const double speed = dem__length(dem__velocity_at(w, i, tau)) + wall->speed_bound + wall->spin_bound * dem__arm(wall, x);
    double **place = w->live_place__, least;
    dem__touch touch[DEM__TOUCHES];
    int n, taken = 0, used = 0, left = 0;
    const double leaves = 2.0 * w->dt__ * speed; /* as far as a contact can open in a step */
    n = dem__touch_mesh(wall, d, w->particle[i].radius, leaves > w->link_near__ ? leaves : w->link_near__, w->particle[i].radius, touch,
                        &least);
    for (int m = 0; m < slots; m++) {
        const int32_t c = slot[m];
        int q = 0;
        used |= 1 << w->live_element__[c];
        while (q < n &&
               ((taken >> q & 1) ||
                !(touch[q].normal.x * place[0][c] + touch[q].normal.y * place[1][c] + touch[q].normal.z * place[2][c] > DEM__SMOOTH)))
            q++;
        if (q == n) { /* merged with another, at whatever depth: no force goes on */
            place[3][c] = w->particle[i].radius;
            w->live_force__[c] = 0.0;
            continue;
        }
        taken |= 1 << q;
        place[0][c] = touch[q].normal.x, place[1][c] = touch[q].normal.y, place[2][c] = touch[q].normal.z;
        place[3][c] = touch[q].gap;
    }
    for (int q = 0; q < n; q++) {
        int32_t free_number = 0;
        if ((taken >> q & 1) || !(touch[q].gap < 0.0)) continue;
        left = 1;
        while (used >> free_number & 1) free_number++;
        if (free_number == DEM__NUMBERS) break;
        used |= 1 << free_number;
        if (bear && !dem__bear_at_wall(w, i, k, &touch[q], free_number)) break;
    }
    return left;
}

/* Follows the contacts with a mesh of which slot c holds the first; of other contacts does nothing. */
static inline int dem__follow_slot(dem_world *w, ptrdiff_t c, int64_t step, int bear) {
    const ptrdiff_t i = w->live_i__[c];
    const int k = -1 - (int)w->live_j__[c];
    int32_t slot[DEM__NUMBERS];
    if (k < 0 || w->wall[k].kind != DEM_MESH) return 0;
    const int slots = dem__contacts_at(w, i, k, slot);
    return slot[0] == c ? dem__follow_mesh(w, i, k, slot, slots, step, bear) : 0;
}

static inline void dem__find_followers(dem_world *w, int64_t step, ptrdiff_t first, ptrdiff_t end) {
    for (const dem__section *in = w->section__ + first; in < w->section__ + end; in++) {
        for (ptrdiff_t c = in->first; c < in->first + in->live; c++) w->live_event__[c] = (uint8_t)dem__follow_slot(w, c, step, 0);
    }
}

/* Contacts with meshes to a step at which the walls already are. */
static inline void dem__follow(dem_world *w, int64_t step) {
    const ptrdiff_t end = dem__next_slot(w), sections = w->sections__;
    const int parts = dem__parts_of(w, w->live_count__, w->sections__);
    int q;
    if (parts == 1) dem__find_followers(w, step, 0, sections);
    else {
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
        for (q = 0; q < parts; q++) dem__find_followers(w, step, dem__part(sections, q, parts), dem__part(sections, q + 1, parts));
    }
    DEM__EACH(w, c) {
        if (c < end && w->live_event__[c] && w->status == DEM_OK) dem__follow_slot(w, c, step, 1);
    }
}

static inline void dem__drop(dem_world *w, ptrdiff_t i, int wall);

/* A straight course at u, from a place d off the axis, leads no further out than d + u_out t + u_side^2 t^2/(2 d): this acceleration. */
DEM_INLINE double dem__bend(const dem_wall *wall, dem_vec u, double from_axis) {
    const double along = dem__dot(u, wall->axis[2]);
    return from_axis > 0.0 ? (dem__dot(u, u) - along * along) / from_axis : HUGE_VAL;
}

/* How near bars may be that are not among those found. */
static inline double dem__other_bars(const dem_world *w, const dem_wall *wall, double radius, const dem__touch *touch, int found) {
    double lowest = 0.0;
    for (int q = 0; q < found; q++) lowest = touch[q].gap < lowest ? touch[q].gap : lowest;
    const double third = dem__third_bar(wall, radius, lowest);
    return third < w->reach__ ? third : w->reach__;
}

/* Time before which particle i cannot touch a wall, by what is known of velocities: better than the bound by speeds alone near a wall, but
   only on this course. A plane, a bar and a cylinder from outside are convex, so that a gap cannot shrink faster than along its normal. */
static inline double dem__time_on_course(const dem_world *w, ptrdiff_t i, const dem_wall *wall, dem_vec v, int k, const dem__touch *touch,
                                         int found, double others) {
    const double stray = 2.0 * w->course__[i].ball, near = w->link_near__ + w->blur__, radius = w->particle[i].radius;
    const dem_vec u = dem__sub(v, wall->velocity), g = w->def.gravity;
    double a = w->fall__ + wall->acceleration_bound, least = HUGE_VAL;
    if (found == 0 || wall->drive != DEM_KINEMATIC || wall->kind > DEM_EXIT || wall->spin != 0.0 || !(a < HUGE_VAL)) return 0.0;
    if (wall->kind == DEM_SCREEN) least = dem__time_to_close(others - near, dem__length(u) + stray, a);
    if (wall->kind == DEM_CYLINDER) {
        const double along = dem__dot(g, wall->axis[2]), from_axis = wall->radius - radius - touch->gap;
        a = sqrt(fabs(dem__dot(g, g) - along * along)) + wall->side_bound;
        if (wall->inside) a += dem__bend(wall, u, from_axis);
    }
    for (int q = 0; q < found; q++) {
        if (wall->kind != DEM_EXIT && dem__touches_element(w, i, k, touch[q].element)) continue;
        const double t = dem__time_to_close(touch[q].gap - near, stray - dem__dot(u, touch[q].normal), a);
        least = t < least ? t : least;
    }
    return least;
}

/* How far it is from x to the face of the periodic box behind which the wall is another one: walls are not repeated. */
static inline double dem__far_from_faces(const dem_world *w, const dem_wall *wall, dem_vec x) {
    double least = HUGE_VAL;
    for (int a = 0; a < 3; a++) {
        const double along = fabs(dem_axis(wall->axis[2], a)), at = dem_axis(x, a);
        const int flat = (wall->kind == DEM_PLANE || wall->kind == DEM_EXIT) && along == 0.0,
                  tube = wall->kind == DEM_CYLINDER && along == 1.0;
        if (!w->def.periodic[a] || (wall->spin_bound == 0.0 && (flat || tube))) continue;
        const double below = at - dem_axis(w->def.low, a), above = dem_axis(w->def.high, a) - at;
        least = below < least ? below : least;
        least = above < least ? above : least;
    }
    return least;
}

/* Looks at particle i and a wall at a step at which the wall already is. */
static inline void dem__look_at_wall(dem_world *w, int32_t e, int64_t step) {
    const ptrdiff_t i = e / w->walls;
    const int k = (int)(e % w->walls);
    int found, touches = 0;
    dem_wall *wall = &w->wall[k];
    w->looks++;
    if (!wall->enabled || !w->alive[i]) return;
    double tau = (double)(step - w->particle[i].origin) * w->dt__, least, others = w->reach__;
    dem_vec x = dem__at(w, i, tau), v = dem__velocity_at(w, i, tau);
    if (w->has_periodic__) x = dem__in_box(w, x); /* where the step will put it: bars are told apart by their place */
    dem__touch touch[DEM__TOUCHES];
    found = dem__touch_wall(wall, x, w->particle[i].radius, w->def.skip & DEM_SKIP_SPACE ? w->reach__ : w->link_near__, touch, &least);
    if (wall->kind == DEM_EXIT) {
        if (least < 0.0) {
            dem__drop(w, i, k);
            return;
        }
    } else if (found > 0) {
        if (wall->kind == DEM_SCREEN) others = dem__other_bars(w, wall, w->particle[i].radius, touch, found);
        least = others;
        for (int q = 0; q < found; q++) {
            if (dem__touches_element(w, i, k, touch[q].element)) continue;
            const int linked = touch[q].gap < w->link_near__ && dem__link_of(w, i, -1 - k, touch[q].element) >= 0;
            if (touch[q].gap < (linked ? w->link_near__ : 0.0)) {
                if (!dem__bear_at_wall(w, i, k, &touch[q], touch[q].element)) return;
                touches = 1;
            } else least = touch[q].gap - w->link_near__ < least ? touch[q].gap - w->link_near__ : least;
        }
        if (touches && wall->kind != DEM_SCREEN) return;
    }
    if (!(w->def.skip & DEM_SKIP_SPACE)) return;
    const double crossing = w->has_periodic__ ? dem__far_from_faces(w, wall, x) : HUGE_VAL;
    least = crossing < least ? crossing : least;
    double speed = dem__length(v) + 2.0 * w->course__[i].ball;
    if (speed < 0.5 * w->wall_speed__[i]) w->wall_speed__[i] = 1.25 * speed;
    speed = (speed > w->wall_speed__[i] ? speed : w->wall_speed__[i]) + wall->speed_bound;
    int most = DEM__FAR;
    if (wall->spin_bound > 0.0) { /* the surface is faster further out, where the particle may be at the next look */
        const double turn = DEM__OFTEN * w->dt__, out = turn * (speed + turn * w->fall__);
        speed += wall->spin_bound * (dem__arm(wall, x) + out);
        most = DEM__OFTEN;
    }
    const int sure = dem__steps_until(w, dem__time_to_cover(least - w->blur__, speed, w->fall__)), steps = sure < most ? sure : most;
    int better = 0;
    if (steps < DEM__OFTEN / 4 && crossing == HUGE_VAL)
        better = dem__steps_until(w, dem__time_on_course(w, i, wall, v, k, touch, found, others));
    w->wall_sure__[e] = (uint32_t)(uint64_t)(step + steps);
    dem__set_timer(&w->wall_timers__, e, step + (better > steps ? better : steps));
}

/* How far links change the velocity of particle i until they are evaluated again, at most [m/s]. */
DEM_INLINE double dem__link_drift(const dem_world *w, ptrdiff_t i) {
    return (double)w->link_stride__ * w->dt__ / w->particle[i].mass * dem__length(dem__first(w->load__[i]));
}

/* At most so far does a pull turn it from its course in a step [m/s]: the sum of parts costs no root. */
DEM_INLINE double dem__way(double dt, dem_vec pull) { return dt * (fabs(pull.x) + fabs(pull.y) + fabs(pull.z)); }

/* Of a particle that has strayed so far from its course: what its ball leaves it beyond this step. */
DEM_INLINE void dem__leave_room(dem_world *w, ptrdiff_t i, double strayed) {
    w->particle[i].room__ = w->course__[i].ball - strayed - dem__way(w->dt__, dem__sub(w->particle[i].a, w->def.gravity));
}

/* A new course for particle i, which is at x and has v at a step. An impact that has just begun takes its velocity to one that is about as
   far behind its middle as it is ahead of that now: one course through the middle, with a ball that holds both, lasts to the end. Else the
   ball holds 16 steps of the present force and a little more: in flight very little, as nothing turns it from its course before a contact
   does, and small balls let neighbours alone for long. */
DEM_INLINE void dem__set_course(dem_world *w, ptrdiff_t i, int64_t step, dem_vec x, dem_vec v) {
    const double t = dem__since_listed(w, step);
    const dem_vec g = w->def.gravity, impact = w->touching[i] == 1 ? w->impact__[i] : dem_vec3(0.0, 0.0, 0.0);
    const dem_vec u = dem__add(v, impact);
    const double turn = dem__length(impact), held = 16.0 * w->dt__ * dem__length(dem__sub(w->particle[i].a, g));
    dem__course *c = &w->course__[i];
    c->ux = u.x - t * g.x, c->uy = u.y - t * g.y, c->uz = u.z - t * g.z;
    c->x = x.x - t * (u.x - 0.5 * t * g.x), c->y = x.y - t * (u.y - 0.5 * t * g.y), c->z = x.z - t * (u.z - 0.5 * t * g.z);
    w->shifted__[i] = 0.0;
    if (turn > 0.0) c->ball = 0.25 * w->slack__ + 1.1 * turn + 0.125 * held; /* and the next step for sure */
    else c->ball = (w->touching[i] == 0 ? 0.001 : 1.0) * w->slack__ + held;
    if (w->links_on__ && w->link_head__[i] >= 0) c->ball += 2.0 * dem__link_drift(w, i);
    c->off = w->particle[i].radius + 0.5 * w->link_near__ + w->blur__ - t * c->ball;
    dem__leave_room(w, i, turn);
}

/* What some threads learn from new courses: when the list is to be asked again, and who is too fast (-1: nobody). */
typedef struct dem__news {
    int64_t check;
    ptrdiff_t fast;
} dem__news;
DEM_INLINE dem__news dem__no_news(const dem_world *w) {
    const dem__news news = {w->next_check__, -1};
    return news;
}
static inline void dem__take_news(dem_world *w, const dem__news *news) {
    if (news->check < w->next_check__) w->next_check__ = news->check;
    if (news->fast < 0 || w->status != DEM_OK) return;
    w->status = DEM_TOO_FAST;
    w->failed_id = w->id[news->fast];
}

/* The frame in which the list waits for somebody to move: where it has gone since, and how fast it is. */
typedef struct dem__list_frame {
    dem_vec way, velocity;
} dem__list_frame;
DEM_INLINE dem__list_frame dem__frame_at(const dem_world *w, int64_t step) {
    const double t = dem__since_listed(w, step);
    dem__list_frame f;
    f.way = dem__scale(t, dem__plus(w->list_velocity__, 0.5 * t, w->list_acceleration__));
    f.velocity = dem__plus(w->list_velocity__, t, w->list_acceleration__);
    return f;
}

/* How far a particle at x with v may still move before it could touch somebody who isn't listed, and how fast it does: in that frame. */
typedef struct dem__leeway {
    double left, speed; /* [m], [m/s] */
} dem__leeway;
DEM_INLINE dem__leeway dem__leeway_of(const dem_world *w, ptrdiff_t i, const dem__list_frame *f, dem_vec x, dem_vec v) {
    dem__leeway q;
    q.left = 0.49 * w->margin__ - dem__length(dem__apart(w, dem__sub(x, dem__add(w->listed_at__[i], f->way))));
    q.speed = dem__length(dem__sub(v, f->velocity)) + 2.0 * w->course__[i].ball;
    return q;
}

/* Steps for which that lasts. */
DEM_INLINE int dem__steps_left(const dem_world *w, const dem__leeway *q) {
    return dem__steps_until(w, dem__time_to_cover(q->left, q->speed, w->list_fall__));
}

/* Is it enough for a time [s]? False for NaN. */
DEM_INLINE int dem__lasts(const dem_world *w, const dem__leeway *q, double time) {
    return q->left > time * (q->speed + 0.5 * w->list_fall__ * time);
}

/* What else a new course of particle i has an effect on, which has been shifted from its last one. Is a wall to be looked at sooner? Then
   dem__hurry_to_walls sees to it. */
static inline int dem__heed_course(dem_world *w, ptrdiff_t i, int64_t step, const dem__list_frame *f, dem_vec x, dem_vec v, double shifted,
                                   dem__news *news) {
    const dem__leeway leeway = dem__leeway_of(w, i, f, x, v);
    double speed = dem__length(v);
    int sooner = 0;
    if (!(speed * w->dt__ <= 0.5 * w->particle[i].radius) && news->fast < 0) news->fast = i;
    speed += 2.0 * w->course__[i].ball;
    if (!dem__lasts(w, &leeway, (double)(news->check - step) * w->dt__)) {
        const int64_t due = leeway.left > 0.0 ? step + dem__steps_left(w, &leeway) : step; /* it was put elsewhere: at once */
        if (due < news->check) news->check = due;
    }
    if (!(w->def.skip & DEM_SKIP_SPACE)) return 0;
    double slower = 1.0; /* what was sure at the speed that the timers of walls counted on takes less time now */
    if (speed > w->wall_speed__[i]) {
        slower = w->wall_speed__[i] / (1.25 * speed);
        w->wall_speed__[i] = 1.25 * speed;
    }
    const double lost = shifted > 0.0 ? 1.0 + shifted / (w->wall_speed__[i] * w->dt__) : 0.0; /* as many steps as it would take */
    for (int k = 0; k < w->walls; k++) {
        const int32_t e = (int32_t)i * w->walls + k;
        if (w->wall_timers__.due[e] == DEM__STOPPED) continue;
        const double left = (double)(dem__steps_sure(w, e, step) - 1) * slower - lost;
        const int now = left > 0.0 ? 1 + (int)left : 1;
        w->wall_sure__[e] = (uint32_t)(uint64_t)(step + now); /* the look finds the time */
        sooner |= now < dem__steps_due(&w->wall_timers__, e, step);
    }
    return sooner;
}
static inline void dem__hurry_to_walls(dem_world *w, ptrdiff_t i, int64_t step) {
    for (int k = 0; k < w->walls; k++) {
        const int32_t e = (int32_t)i * w->walls + k;
        const int sure = dem__steps_sure(w, e, step), due = w->wall_timers__.due[e];
        if (due != DEM__STOPPED && sure < dem__steps_due(&w->wall_timers__, e, step)) dem__set_timer(&w->wall_timers__, e, step + sure);
    }
}

/* A new course for particle i, and what else it has an effect on; its pairs are left to dem__restart. By one thread. */
static inline void dem__begin_course(dem_world *w, ptrdiff_t i, int64_t step) {
    const double shifted = w->shifted__[i], tau = (double)(step - w->particle[i].origin) * w->dt__;
    const dem_vec x = dem__at(w, i, tau), v = dem__velocity_at(w, i, tau);
    const dem__list_frame frame = dem__frame_at(w, step);
    dem__news news = dem__no_news(w);
    dem__set_course(w, i, step, x, v);
    if (dem__heed_course(w, i, step, &frame, x, v, shifted, &news)) dem__hurry_to_walls(w, i, step);
    dem__take_news(w, &news);
}

/* All look at wall k at a step. */
static inline void dem__hurry(dem_world *w, int k, int64_t step) {
    for (ptrdiff_t i = 0; i < w->count && (w->def.skip & DEM_SKIP_SPACE); i++) {
        const int32_t e = (int32_t)i * w->walls + k;
        if (w->wall_timers__.due[e] != DEM__STOPPED) dem__set_timer(&w->wall_timers__, e, step);
    }
}

/* Walls to a step. Timers count on a bound of each wall's speed: a driven wall that has just outrun its own gets a larger one, and is
   looked at by all in this very step. */
static inline int dem__move_walls(dem_world *w, int64_t step) {
    const double time = w->start_time__ + (double)(step - w->start_step__) * w->dt__;
    const dem_wall *last = NULL;
    dem__sway sway;
    for (int k = 0; k < w->walls; k++) {
        dem_wall *a = &w->wall[k];
        if (a->drive == DEM_KINEMATIC) {
            if (!(a->speed_bound > 0.0 || a->spin_bound > 0.0)) continue;
            if (!last || !dem__sways_with(a, last)) sway = dem__sway_at(a, time - a->motion_start);
            dem__kinematic_wall(a, time - a->motion_start, &sway);
            last = a;
            continue;
        }
        const dem_vec from = a->position, axis[3] = {a->axis[0], a->axis[1], a->axis[2]};
        double turn = 0.0;
        dem__move_wall(a, time);
        if (!dem__wall_is_finite(a)) return 0;
        const double speed = dem__length(dem__sub(a->position, from)) / w->dt__;
        for (int q = 0; q < 3; q++) { /* at least one axis turns by sqrt(2/3) of the angle */
            const double tip = 1.25 * dem__length(dem__sub(a->axis[q], axis[q])) / w->dt__;
            turn = tip > turn ? tip : turn;
        }
        if (speed <= a->speed_bound && turn <= a->spin_bound) continue;
        a->speed_bound = speed > a->speed_bound ? 1.5 * speed : a->speed_bound;
        a->spin_bound = turn > a->spin_bound ? 1.5 * turn : a->spin_bound;
        dem__hurry(w, k, step);
    }
    return 1;
}

/* Ahead of new timers. */
DEM_INLINE void dem__fetch_neighbours(const dem_world *w, ptrdiff_t i) {
    for (int32_t k = w->adjacent_start__[i]; k < w->adjacent_start__[i + 1]; k++) {
        DEM__PREFETCH(&w->pair_timers__.due[w->adjacent__[2 * k]]);
        DEM__PREFETCH(&w->course__[w->adjacent__[2 * k + 1]]);
    }
}

/* Has particle i pairs from low to high - 1? They are listed in order. */
DEM_INLINE int dem__has_pairs(const dem_world *w, ptrdiff_t i, ptrdiff_t low, ptrdiff_t high) {
    const int32_t begin = w->adjacent_start__[i], stop = w->adjacent_start__[i + 1];
    return begin < stop && w->adjacent__[2 * begin] < high && w->adjacent__[2 * stop - 2] >= low;
}

/* New timers for those pairs of particles with new courses that are in sheaves first .. end-1. */
DEM_INLINE void dem__wait_for_all(dem_world *w, const int32_t *restarted, ptrdiff_t n, ptrdiff_t first, ptrdiff_t end, int64_t step) {
    const ptrdiff_t low = first * DEM__SHEAF, high = end * DEM__SHEAF;
    const double t = dem__since_listed(w, step);
    dem__waits waits;
    dem__no_waits(&waits);
    for (ptrdiff_t m = -16; m < n; m++) {
        /* ahead: where the list of neighbours begins, the list, then what it lists */
        if (m + 16 < n) DEM__PREFETCH(&w->adjacent_start__[restarted[m + 16]]);
        if (m >= -8 && m + 8 < n) {
            const int32_t *list = &w->adjacent__[2 * w->adjacent_start__[restarted[m + 8]]];
            DEM__PREFETCH(list);
            DEM__PREFETCH(list + 16);
        }
        if (m >= -2 && m + 2 < n && dem__has_pairs(w, restarted[m + 2], low, high)) dem__fetch_neighbours(w, restarted[m + 2]);
        if (m < 0 || !dem__has_pairs(w, restarted[m], low, high)) continue;
        const int32_t i = restarted[m], begin = w->adjacent_start__[i], stop = w->adjacent_start__[i + 1];
        const dem__course own = dem__course_at(&w->course__[i], t);
        for (int32_t k = begin; k < stop; k++) {
            const int32_t p = w->adjacent__[2 * k];
            if (p < low || p >= high || w->pair_timers__.due[p] == DEM__STOPPED) continue;
            const dem__course other = dem__course_at(&w->course__[w->adjacent__[2 * k + 1]], t);
            dem__wait_on_courses(w, &waits, p, step, &own, &other);
        }
    }
    dem__set_waits(w, &waits, step);
}
DEM__TWICE(dem__wait_anew, (dem_world * w, const int32_t *restarted, ptrdiff_t n, ptrdiff_t first, ptrdiff_t end, int64_t step),
           (w, restarted, n, first, end, step), dem__wait_for_all(w, restarted, n, first, end, step))

/* New timers for the pairs of the listed particles, which have new courses. */
static inline void dem__restart(dem_world *w, const int32_t *restarted, ptrdiff_t n, int64_t step) {
    const ptrdiff_t sheaves = w->pair_timers__.sheaves;
    const int parts = dem__parts(w, 4 * n);
    int q;
    if (!(w->def.skip & DEM_SKIP_PAIRS)) return;
    if (parts == 1) {
        dem__wait_anew(w, restarted, n, 0, sheaves, step);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
    for (q = 0; q < parts; q++) dem__wait_anew(w, restarted, n, dem__part(sheaves, q, parts), dem__part(sheaves, q + 1, parts), step);
}

/* Active particles in the order of memory. */
static inline void dem__list_active(dem_world *w) {
    w->active_count__ = w->unsettled_count__ = 0;
    for (int32_t i = 0; i < (int32_t)w->count; i++) {
        w->active__[w->active_count__] = i;
        w->active_count__ += w->is_active__[i] != 0;
        if (w->is_active__[i] == 2) w->unsettled__[w->unsettled_count__++] = i;
    }
}

/* Wall timers of the `left` particles that remap__ keeps, under their new numbers. */
static inline void dem__move_wall_timers(dem_world *w, ptrdiff_t left) {
    dem__timers *t = &w->wall_timers__;
    if (w->stale__) return; /* they are made anew */
    for (ptrdiff_t i = 0; i < w->count; i++) {
        for (int k = 0; k < w->walls && w->remap__[i] >= 0; k++) {
            t->due[w->remap__[i] * w->walls + k] = t->due[i * w->walls + k];
            w->wall_sure__[w->remap__[i] * w->walls + k] = w->wall_sure__[i * w->walls + k];
        }
    }
    dem__stop_timers(t, left * w->walls, left * w->walls);
}

DEM_INLINE void dem__close_gaps(char *base, size_t size, const int32_t *remap, ptrdiff_t first, ptrdiff_t count) {
    for (ptrdiff_t i = first; i < count; i++) {
        if (remap[i] >= 0) memcpy(base + (size_t)remap[i] * size, base + (size_t)i * size, size);
    }
}

/* The number of particle i, or of the first after it that stays, when those are numbered by remap__. */
static inline int32_t dem__remapped(const dem_world *w, int32_t i) {
    while (i < (int32_t)w->count && w->remap__[i] < 0) i++;
    return i < (int32_t)w->count ? w->remap__[i] : (int32_t)(w->count - w->dropped__);
}

/* Takes dropped particles out of the arrays, keeping the order of the others. */
static inline void dem__compact(dem_world *w) {
    if (!w->dropped__) return;
    ptrdiff_t to = 0;
    dem__array list[DEM__ARRAYS_MAX];
    int n = dem__particle_arrays(w, list);
    for (ptrdiff_t i = 0; i < w->count; i++) w->remap__[i] = w->alive[i] ? (int32_t)to++ : -1;
    int32_t *remap = w->remap__;
    ptrdiff_t first = 0;
    while (first < w->count && remap[first] == first) first++;
    for (int k = 0; k < n; k++) {
        char *base;
        memcpy(&base, list[k].address, sizeof base);
        if ((void *)base == (void *)remap) continue;
        if (list[k].size == sizeof(double)) dem__close_gaps(base, sizeof(double), remap, first, w->count);
        else if (list[k].size == sizeof(int32_t)) dem__close_gaps(base, sizeof(int32_t), remap, first, w->count);
        else dem__close_gaps(base, list[k].size, remap, first, w->count);
    }
    dem__move_wall_timers(w, to);
    DEM__EACH(w, c) {
        w->live_i__[c] = remap[w->live_i__[c]];
        if (w->live_j__[c] >= 0) w->live_j__[c] = remap[w->live_j__[c]];
    }
    for (int q = 0; q < w->sections__; q++) w->section__[q].from = dem__remapped(w, w->section__[q].from);
    for (ptrdiff_t k = 0; k < w->link_count__; k++) {
        w->link_i__[k] = remap[w->link_i__[k]];
        if (w->link_j__[k] >= 0) w->link_j__[k] = remap[w->link_j__[k]];
    }
    w->count = to;
    w->dropped__ = 0;
}

/* One level of cells for the spheres of one size class: those up to DEM__CLASS times as large as its smallest. */
typedef struct dem__grid {
    double low[3], inverse[3]; /* corner, 1 / cell size by axis */
    double widest;             /* radius of its largest sphere */
    int32_t n[3], wraps[3];
    ptrdiff_t count, first; /* spheres; its first cell in the common list */
} dem__grid;

#define DEM__CLASS 2.5         /* between 2 and 3 the time is the same: fewer levels, but more spheres in a cell */
enum { DEM__LEVELS_MAX = 16 }; /* beyond 1 : 2.5^15 the last takes all */

DEM_INLINE int dem__level(double radius, double smallest) {
    int level = 0;
    for (double bound = DEM__CLASS * smallest; radius >= bound && level < DEM__LEVELS_MAX - 1; level++) bound *= DEM__CLASS;
    return level;
}

/* Where the bulk of the points lies: four standard deviations each way from the mean, and again among those within as long as that
   halves the span. The few outside, which have gone astray, are put into the cells at the border and do not make all cells large. */
static inline void dem__bulk(const dem_vec *point, int axis, ptrdiff_t n, double *low, double *high) {
    double from = HUGE_VAL, to = -HUGE_VAL, span;
    for (ptrdiff_t i = 0; i < n; i++) {
        const double v = dem_axis(point[i], axis);
        from = v < from ? v : from;
        to = v > to ? v : to;
    }
    do {
        double sum = 0.0, square = 0.0, inside = 0.0;
        span = to - from;
        for (ptrdiff_t i = 0; i < n; i++) {
            const double v = dem_axis(point[i], axis), d = v - from;
            if (!(v >= from && v <= to)) continue;
            sum += d, square += d * d, inside += 1.0;
        }
        const double mean = sum / inside, variance = square / inside - mean * mean, reach = variance > 0.0 ? 4.0 * sqrt(variance) : 0.0;
        to = mean + reach < span ? from + (mean + reach) : to;
        from = mean - reach > 0.0 ? from + (mean - reach) : from;
    } while (to > from && to - from < 0.5 * span);
    *low = from, *high = to;
}

/* Cells no smaller than `size` over a box, at most four a sphere. */
static inline void dem__make_grid(const dem_world *w, dem__grid *g, double size, dem_vec low, dem_vec high) {
    double span[3];
    for (int a = 0; a < 3; a++) {
        g->wraps[a] = w->def.periodic[a];
        g->low[a] = dem_axis(g->wraps[a] ? w->def.low : low, a);
        span[a] = dem_axis(g->wraps[a] ? w->def.high : high, a) - g->low[a];
    }
    for (;; size *= 1.26) {
        double cells = 1.0;
        for (int a = 0; a < 3; a++) cells *= floor(span[a] / size) + 1.0;
        if (!(cells > 4.0 * (double)g->count + 64.0)) break; /* NaN: an infinite span has one cell */
    }
    for (int a = 0; a < 3; a++) {
        const double n = floor(span[a] / size);
        g->n[a] = n > 1.0 ? (int32_t)n : 1; /* periodic: whole cells, each a little larger */
        g->inverse[a] = g->wraps[a] ? g->n[a] / span[a] : 1.0 / size;
        if (!g->wraps[a]) g->n[a]++;
    }
}

/* The cells of an axis that [v - reach, v + reach] meets: from *first, so many, to be wrapped; each at most once. */
DEM_INLINE int32_t dem__cells(const dem__grid *g, int a, double v, double reach, int32_t *first) {
    const double from = (v - reach - g->low[a]) * g->inverse[a], to = (v + reach - g->low[a]) * g->inverse[a], last = (double)(g->n[a] - 1);
    if (g->wraps[a]) {
        const double low = floor(from), high = floor(to);
        *first = 0;
        if (!(high - low < last)) return g->n[a];
        *first = (int32_t)low; /* v itself is in the box, or at its upper end */
        *first += *first < 0 ? g->n[a] : (*first >= g->n[a] ? -g->n[a] : 0);
        return (int32_t)(high - low) + 1;
    }
    *first = (int32_t)(from > 0.0 ? (from < last ? from : last) : 0.0);
    return (int32_t)(to > 0.0 ? (to < last ? to : last) : 0.0) - *first + 1;
}

DEM_INLINE ptrdiff_t dem__cell(const dem__grid *g, dem_vec at) {
    int32_t cx, cy, cz;
    dem__cells(g, 0, at.x, 0.0, &cx), dem__cells(g, 1, at.y, 0.0, &cy), dem__cells(g, 2, at.z, 0.0, &cz);
    return g->first + ((ptrdiff_t)cz * g->n[1] + cy) * g->n[0] + cx;
}

/* The near pairs that a thread finds, and room for so many. */
typedef struct dem__finds {
    dem__near *pair;
    ptrdiff_t n, room;
    int full;
} dem__finds;

static inline int dem__add_near(const dem_world *w, dem__finds *finds, int32_t i, int32_t j) {
    if (finds->n == finds->room) return 0;
    dem__near *q = &finds->pair[finds->n++];
    q->i = i < j ? i : j;
    q->j = i < j ? j : i;
    q->distance = w->particle[i].radius + w->particle[j].radius;
    return 1;
}

/* Spheres that those of a cell may be near to. */
enum { DEM__CROWD = 256 }; /* twice what a cell and its neighbours hold in a dense bed of like spheres */
typedef struct dem__crowd {
    double x[DEM__CROWD], y[DEM__CROWD], z[DEM__CROWD], extent[DEM__CROWD];
    int32_t at[DEM__CROWD]; /* in the sorted list */
    int n;
} dem__crowd;

/* The nearest image of a distance of two places within the periodic box. */
DEM_INLINE double dem__image(double d, double length) {
    d = d > 0.5 * length ? d - length : d;
    return d < -0.5 * length ? d + length : d;
}

/* Those of a crowd that are near a sphere: their numbers in it, and how many. Without a branch, which nobody could predict. */
DEM_INLINE void dem__choose_near(const dem__crowd *c, const dem__course *s, const double *length, int32_t *near, int *count) {
    double room[DEM__CROWD];
    int m = 0;
    for (int k = 0; k < c->n; k++) {
        double x = s->x - c->x[k], y = s->y - c->y[k], z = s->z - c->z[k];
        if (length) x = dem__image(x, length[0]), y = dem__image(y, length[1]), z = dem__image(z, length[2]);
        const double sum = s->ball + c->extent[k];
        room[k] = x * x + y * y + z * z - sum * sum;
    }
    for (int k = 0; k < c->n; k++) {
        near[m] = k;
        m += room[k] < 0.0;
    }
    *count = m;
}
DEM__TWICE(dem__choose, (const dem__crowd *c, const dem__course *s, const double *length, int32_t *near, int *count),
           (c, s, length, near, count), dem__choose_near(c, s, length, near, count))

/* Length of the box along an axis, HUGE_VAL where it is not periodic. */
DEM_INLINE double dem__period(const dem_world *w, int axis) {
    return w->def.periodic[axis] ? dem_axis(w->def.high, axis) - dem_axis(w->def.low, axis) : HUGE_VAL;
}
static inline double dem__narrowest(const dem_world *w) {
    double narrowest = HUGE_VAL;
    for (int a = 0; a < 3; a++) narrowest = dem__period(w, a) < narrowest ? dem__period(w, a) : narrowest;
    return narrowest;
}

/* The near pairs of spheres first .. end-1 of the sorted list with those after each that a crowd holds. Returns 0 if there is no room. */
static inline int dem__meet(const dem_world *w, const dem__crowd *crowd, int32_t first, int32_t end, dem__finds *finds) {
    const double length[3] = {dem__period(w, 0), dem__period(w, 1), dem__period(w, 2)};
    int32_t near[DEM__CROWD];
    for (int32_t p = first; p < end; p++) {
        int n;
        dem__choose(crowd, &w->course__[p], w->has_periodic__ ? length : NULL, near, &n);
        for (int k = 0; k < n; k++) {
            const int32_t q = crowd->at[near[k]];
            if (q > p && !dem__add_near(w, finds, w->remap__[p], w->remap__[q])) return 0;
        }
    }
    return 1;
}

/* The near pairs of spheres first .. end-1 of the sorted list, all of one cell, with those after each on one level. */
static inline int dem__find_pairs_of(const dem_world *w, const dem__grid *g, int32_t first, int32_t end, dem__finds *finds) {
    const int32_t *start = w->cells__;
    const dem__course *scratch = w->course__;
    dem_vec low = dem_vec3(scratch[first].x, scratch[first].y, scratch[first].z), high = low;
    double extent = 0.0;
    dem__crowd crowd;
    for (int32_t p = first; p < end; p++) {
        low.x = scratch[p].x < low.x ? scratch[p].x : low.x, high.x = scratch[p].x > high.x ? scratch[p].x : high.x;
        low.y = scratch[p].y < low.y ? scratch[p].y : low.y, high.y = scratch[p].y > high.y ? scratch[p].y : high.y;
        low.z = scratch[p].z < low.z ? scratch[p].z : low.z, high.z = scratch[p].z > high.z ? scratch[p].z : high.z;
        extent = scratch[p].ball > extent ? scratch[p].ball : extent;
    }
    const double reach = extent + g->widest + 0.5 * w->margin__;
    int32_t from[3], cells[3];
    for (int a = 0; a < 3; a++) {
        const double l = dem_axis(low, a), h = dem_axis(high, a);
        cells[a] = dem__cells(g, a, 0.5 * (l + h), 0.5 * (h - l) + reach, &from[a]);
    }
    const int32_t before = cells[0] < g->n[0] - from[0] ? cells[0] : g->n[0] - from[0]; /* cells of a row before it wraps */
    crowd.n = 0;
    for (int32_t row = 0; row < cells[1] * cells[2]; row++) {
        const int32_t cy = from[1] + row % cells[1], cz = from[2] + row / cells[1];
        const int32_t iy = cy < g->n[1] ? cy : cy - g->n[1], iz = cz < g->n[2] ? cz : cz - g->n[2];
        const int32_t *cell = start + g->first + ((ptrdiff_t)iz * g->n[1] + iy) * g->n[0];
        for (int part = 0; part < 2; part++) { /* neighbours in a row of cells are neighbours in the list */
            const int32_t last = part ? cell[cells[0] - before] : cell[from[0] + before];
            int32_t q = part ? cell[0] : cell[from[0]];
            for (q = q > first ? q : first; q < last; q++) {
                if (crowd.n == DEM__CROWD) {
                    if (!dem__meet(w, &crowd, first, end, finds)) return 0;
                    crowd.n = 0;
                }
                crowd.x[crowd.n] = scratch[q].x, crowd.y[crowd.n] = scratch[q].y, crowd.z[crowd.n] = scratch[q].z;
                crowd.extent[crowd.n] = scratch[q].ball;
                crowd.at[crowd.n++] = q;
            }
        }
    }
    return dem__meet(w, &crowd, first, end, finds);
}

/* Puts the spheres into cells, one grid for each size class: sorted by class, then by cell. The number of classes; 0 when out of memory.
   The courses serve as scratch: a rebuild sets all of them. */
static inline int dem__fill_cells(dem_world *w, dem__grid *grid) {
    double smallest = HUGE_VAL;
    dem_vec low, high;
    int32_t *sorted = w->remap__;
    ptrdiff_t cells = 0;
    int levels = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) smallest = w->particle[i].radius < smallest ? w->particle[i].radius : smallest;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const double r = w->particle[i].radius;
        const int level = dem__level(r, smallest);
        if (!w->alive[i]) continue;
        grid[level].widest = r > grid[level].widest ? r : grid[level].widest;
        grid[level].count++;
        sorted[i] = level;
    }
    for (int a = 0; a < 3; a++) dem__bulk(w->listed_at__, a, w->count, dem_axis_of(&low, a), dem_axis_of(&high, a));
    for (int level = 0; level < DEM__LEVELS_MAX; level++) {
        dem__grid *g = &grid[level];
        if (g->count == 0) continue;
        levels = level + 1;
        dem__make_grid(w, g, 2.0 * g->widest + w->margin__, low, high);
        g->first = cells;
        cells += (ptrdiff_t)g->n[0] * g->n[1] * g->n[2];
    }
    if (!dem__grow_one(w, &w->cells__, &w->cells_capacity__, cells + 1)) return 0;
    int32_t *start = w->cells__;
    for (ptrdiff_t c = 0; c <= cells; c++) start[c] = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        const ptrdiff_t c = dem__cell(&grid[sorted[i]], w->listed_at__[i]);
        w->cell_next__[i] = (int32_t)c;
        start[c]++;
    }
    for (ptrdiff_t c = 0, sum = 0; c <= cells; c++) {
        sum += start[c];
        start[c] = (int32_t)sum;
    }
    for (ptrdiff_t i = w->count - 1; i >= 0; i--) {
        if (!w->alive[i]) continue;
        const int32_t k = --start[w->cell_next__[i]];
        sorted[k] = (int32_t)i;
        w->course__[k].x = w->listed_at__[i].x, w->course__[k].y = w->listed_at__[i].y, w->course__[k].z = w->listed_at__[i].z;
        w->course__[k].ball = w->particle[i].radius + 0.5 * w->margin__;
    }
    return levels;
}

/* The near pairs of the spheres whose cells begin in first .. end-1 of the sorted list: those of a cell look at the cells around it on
   their own level and the coarser ones, and there at those after them in the list. Returns 0 if there is no room. */
static inline int dem__find_in(const dem_world *w, const dem__grid *grid, int levels, ptrdiff_t first, ptrdiff_t end, dem__finds *finds) {
    const int32_t *start = w->cells__;
    ptrdiff_t of_level = 0, p = first;
    finds->n = 0;
    for (int level = 0; level < levels; level++) {
        for (of_level += grid[level].count; p < of_level && p < end;) {
            const int32_t cell = w->cell_next__[w->remap__[p]], from = start[cell], to = start[cell + 1];
            for (int other = level; other < levels && from == p; other++) {
                if (grid[other].count > 0 && !dem__find_pairs_of(w, &grid[other], from, to, finds)) return 0;
            }
            p = to;
        }
    }
    return 1;
}

/* Finds the near pairs: gap below margin. Threads search parts of the sorted spheres; if one has no room, all search again with more.
   Returns 0 when out of memory. */
static inline int dem__find_pairs(dem_world *w) {
    dem__grid grid[DEM__LEVELS_MAX];
    dem__finds finds[DEM__PARTS_MAX];
    ptrdiff_t room = w->count < INT32_MAX / 24 ? 6 * w->count : INT32_MAX / 4, present = 0;
    int q, full = 1;
    w->near_count__ = 0;
    if (w->count == 0) return 1;
    memset(grid, 0, sizeof grid);
    const int levels = dem__fill_cells(w, grid), parts = dem__parts(w, w->count);
    for (int level = 0; level < levels; level++) present += grid[level].count;
    while (full) {
        if (levels == 0 || room > INT32_MAX / 2 || !dem__grow_near(w, room)) return 0;
        room = w->pair_timers__.capacity * DEM__BUNCH;
        full = 0;
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts) if (parts > 1)
#endif
        for (q = 0; q < parts; q++) {
            finds[q].pair = w->near__ + dem__part(room, q, parts);
            finds[q].room = dem__part(room, q + 1, parts) - dem__part(room, q, parts);
            finds[q].full = !dem__find_in(w, grid, levels, dem__part(present, q, parts), dem__part(present, q + 1, parts), &finds[q]);
        }
        for (q = 0; q < parts; q++) full |= finds[q].full;
        room++;
    }
    for (q = 0; q < parts; q++) {
        memmove(w->near__ + w->near_count__, finds[q].pair, (size_t)finds[q].n * sizeof *w->near__);
        w->near_count__ += finds[q].n;
    }
    return 1;
}

/* The near pairs of each particle, both ways. */
static inline int dem__find_adjacent(dem_world *w) {
    if (w->count == 0) return 1;
    if (!dem__grow_one(w, &w->adjacent__, &w->adjacent_capacity__, 4 * w->near_count__)) return 0;
    int32_t *start = w->adjacent_start__;
    for (ptrdiff_t i = 0; i <= w->count; i++) start[i] = 0;
    for (ptrdiff_t p = 0; p < w->near_count__; p++) start[w->near__[p].i]++, start[w->near__[p].j]++;
    for (ptrdiff_t i = 0, sum = 0; i <= w->count; i++) {
        sum += start[i];
        start[i] = (int32_t)sum;
    }
    for (ptrdiff_t p = w->near_count__ - 1; p >= 0; p--) {
        const int32_t i = w->near__[p].i, j = w->near__[p].j, a = --start[i], b = --start[j];
        w->adjacent__[2 * a] = w->adjacent__[2 * b] = (int32_t)p;
        w->adjacent__[2 * a + 1] = j, w->adjacent__[2 * b + 1] = i;
    }
    return 1;
}

/* The near pair of two particles, or -1. */
static inline int32_t dem__near_pair(const dem_world *w, int32_t i, int32_t j) {
    if (w->stale__) return -1;
    for (int32_t a = w->adjacent_start__[i]; a < w->adjacent_start__[i + 1]; a++) {
        if (w->adjacent__[2 * a + 1] == j) return w->adjacent__[2 * a];
    }
    return -1;
}

static inline void dem__list_wall_contacts(dem_world *w) {
    for (ptrdiff_t i = 0; i < w->count; i++) w->wall_head__[i] = -1;
    DEM__EACH(w, c) {
        if (w->live_j__[c] >= 0) continue;
        w->live_wall_next__[c] = w->wall_head__[w->live_i__[c]];
        w->wall_head__[w->live_i__[c]] = (int32_t)c;
    }
}

/* Which near pair a live contact is. */
static inline void dem__find_contacts(dem_world *w) {
    DEM__EACH(w, c) {
        const int32_t p = w->live_j__[c] < 0 ? -1 : dem__near_pair(w, w->live_i__[c], w->live_j__[c]);
        w->live_near__[c] = p;
        if (p >= 0) dem__stop_timer(&w->pair_timers__, p);
    }
}

/* Near pair p (or -1) is linked, or not any more. */
DEM_INLINE void dem__mark_link(dem_world *w, int32_t p, int linked) {
    if (p < 0) return;
    dem__near *q = &w->near__[p];
    q->distance = w->particle[q->i].radius + w->particle[q->j].radius + (linked ? w->link_near__ : 0.0);
}

DEM_INLINE void dem__list_link(dem_world *w, int32_t k) {
    const int32_t i = w->link_i__[k], j = w->link_j__[k];
    w->link_next_i__[k] = w->link_head__[i];
    w->link_head__[i] = k;
    if (j < 0) return;
    const int32_t p = dem__near_pair(w, i, j);
    w->link_next_j__[k] = w->link_head__[j];
    w->link_head__[j] = k;
    dem__mark_link(w, p, 1);
}

static inline void dem__find_links(dem_world *w) {
    for (ptrdiff_t i = 0; i < w->count; i++) w->link_head__[i] = -1;
    for (int32_t k = 0; k < (int32_t)w->link_count__; k++) dem__list_link(w, k);
}

/* Timers of all near pairs that do not touch, in sheaves first .. end-1. */
DEM_INLINE void dem__wait_for_new(dem_world *w, ptrdiff_t first, ptrdiff_t end) {
    const double t = dem__since_listed(w, w->step);
    dem__waits waits;
    dem__no_waits(&waits);
    for (ptrdiff_t p = first * DEM__SHEAF; p < end * DEM__SHEAF; p++) {
        if (w->pair_timers__.due[p] == DEM__STOPPED) continue;
        const dem__course a = dem__course_at(&w->course__[w->near__[p].i], t), b = dem__course_at(&w->course__[w->near__[p].j], t);
        dem__wait_on_courses(w, &waits, (int32_t)p, w->step, &a, &b);
    }
    dem__set_waits(w, &waits, w->step);
}
DEM__TWICE(dem__wait_in, (dem_world * w, ptrdiff_t first, ptrdiff_t end), (w, first, end), dem__wait_for_new(w, first, end))
static inline void dem__wait_all(dem_world *w) {
    const ptrdiff_t sheaves = w->pair_timers__.sheaves;
    const int parts = dem__parts(w, w->near_count__);
    int q;
    if (!(w->def.skip & DEM_SKIP_PAIRS)) return;
    if (parts == 1) {
        dem__wait_in(w, 0, sheaves);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
    for (q = 0; q < parts; q++) dem__wait_in(w, dem__part(sheaves, q, parts), dem__part(sheaves, q + 1, parts));
}

/* Timers for a new list: pairs apart; walls as they are, or all stopped. */
static inline int dem__make_timers(dem_world *w, int keeps) {
    const ptrdiff_t walls = w->count * w->walls;
    dem__timers *pair = &w->pair_timers__, *wall = &w->wall_timers__;
    if (!dem__grow_near(w, w->near_count__)) return 0;
    for (ptrdiff_t p = 0; p < w->near_count__; p++) pair->due[p] = DEM__NEVER;
    dem__stop_timers(pair, w->near_count__, w->near_count__);
    pair->from = w->step;
    if (!keeps) {
        if (!dem__grow_timers(w, wall, walls, &w->wall_sure__, sizeof *w->wall_sure__)) return 0;
        dem__stop_timers(wall, 0, walls);
        wall->from = w->step;
    } else dem__count_from(wall, w->step);
    return 1;
}

/* The list waits for somebody to move in the frame of what most do: it drifts at their mean velocity, and falls with them if they fly. */
static inline void dem__choose_frame(dem_world *w) {
    const int flies = 2 * w->active_count__ < w->count;
    dem_vec sum = dem_vec3(0.0, 0.0, 0.0);
    double n = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i]) sum = dem__add(sum, dem__velocity_at(w, i, dem__now(w, i))), n += 1.0;
    }
    w->list_velocity__ = n > 0.0 ? dem__scale(1.0 / n, sum) : sum;
    w->list_acceleration__ = flies ? w->def.gravity : dem_vec3(0.0, 0.0, 0.0);
    w->list_fall__ = flies ? 0.0 : w->fall__;
}

/* Builds everything that is about who is near whom. Timers of walls stay unless something changed from outside. */
static DEM__APART int dem__rebuild(dem_world *w) {
    const int keeps = !w->stale__;
    if (!keeps || w->dropped__ > w->count / 16) dem__compact(w); /* it costs about as much as finding the pairs */
    dem__list_active(w);
    double smallest = HUGE_VAL, largest = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        const dem_vec x = dem__in_box(w, dem__at(w, i, dem__now(w, i)));
        w->listed_at__[i] = x;
        smallest = w->particle[i].radius < smallest ? w->particle[i].radius : smallest;
        largest = w->particle[i].radius > largest ? w->particle[i].radius : largest;
        if (!(fabs(x.x) < 1e100 && fabs(x.y) < 1e100 && fabs(x.z) < 1e100)) {
            w->status = DEM_NOT_FINITE;
            w->failed_id = w->id[i];
            return 0;
        }
    }
    w->pace__ = (1.0 - 1e-9) / w->dt__; /* steps a second, not rounded up */
    const int few = w->near_count__ < DEM__FEW_PAIRS * w->count, lasts = few ? 4 * DEM__LIST_STEPS : DEM__LIST_STEPS;
    if (keeps) w->stretch__ *= (double)lasts / (double)(w->step - w->listed__ + 1);
    w->stretch__ = dem__clamp(w->stretch__, 1.0, 3.0);
    const double wanted = 2.0 * smallest * w->def.skin * w->stretch__, room = 0.5 * dem__narrowest(w) - 2.0 * largest; /* to an image */
    w->margin__ = w->count == 0 ? 1.0 : wanted < room ? wanted : room;
    w->slack__ = 0.05 * w->margin__ / (DEM__OFTEN * w->dt__);
    w->reach__ = 4.0 * w->margin__;
    w->blur__ = 2e-6 * smallest; /* as much as slow contacts shift; faster ones are rarer than looks at those who are that near */
    w->fall__ = dem__length(w->def.gravity);
    dem__choose_frame(w);
    if (!dem__find_pairs(w) || !dem__find_adjacent(w)) {
        w->status = DEM_OUT_OF_MEMORY;
        return 0;
    }
    if (!(w->link_near__ <= 0.01 * w->margin__) && w->link_count__ > 0) {
        w->status = DEM_BAD_DEFINITION;
        return 0;
    }
    if (w->near_count__ > INT32_MAX / 4 || w->count * w->walls > INT32_MAX / 2) {
        w->status = DEM_TOO_MANY;
        return 0;
    }
    if (!dem__make_timers(w, keeps)) {
        w->status = DEM_OUT_OF_MEMORY;
        return 0;
    }
    w->stale__ = 0;
    dem__list_wall_contacts(w);
    dem__find_contacts(w);
    dem__find_links(w);
    w->next_check__ = w->step + DEM__FAR;
    w->listed__ = w->step;
    w->rebuilds++;
    for (ptrdiff_t i = 0; i < w->count && !keeps; i++) w->wall_speed__[i] = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i]) dem__begin_course(w, i, w->step);
    }
    dem__wait_all(w);
    if (w->status != DEM_OK) return 0;
    for (int k = 0; k < w->walls; k++) { /* bounds of driven walls may shrink here */
        dem_wall *a = &w->wall[k];
        const double speed = 1.5 * dem__length(a->velocity), spin = 1.5 * fabs(a->spin);
        if (a->drive == DEM_KINEMATIC || (speed > 0.5 * a->speed_bound && spin >= 0.5 * a->spin_bound)) continue;
        a->speed_bound = speed, a->spin_bound = spin;
        if (keeps) dem__hurry(w, k, w->step + 1);
    }
    for (ptrdiff_t i = 0; i < w->count && !keeps && (w->def.skip & DEM_SKIP_SPACE); i++) {
        for (int k = 0; k < w->walls; k++) {
            if (dem__awaits(w, i, k)) dem__set_timer(&w->wall_timers__, (int32_t)i * w->walls + k, w->step + 1);
        }
    }
    return 1;
}

/* Has anything moved so far that an unlisted pair could touch soon? Then rebuild, else say when to ask again. */
static DEM__APART int dem__check_list(dem_world *w) {
    const dem__list_frame frame = dem__frame_at(w, w->step);
    int64_t due = w->listed__ + DEM__FAR;
    if (w->step >= due) return dem__rebuild(w);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        const double tau = dem__now(w, i);
        const dem__leeway leeway = dem__leeway_of(w, i, &frame, dem__at(w, i, tau), dem__velocity_at(w, i, tau));
        if (dem__lasts(w, &leeway, (double)(due - w->step) * w->dt__)) continue;
        const int steps = dem__steps_left(w, &leeway);
        if (steps < 12) return dem__rebuild(w);
        due = w->step + steps;
    }
    w->next_check__ = due;
    return 1;
}

/* ------------------------------------------------------------------------------------------------ >>kernel */

/* What the overlap makes of the law's normal force, within contact, at given gap and closing speed, its history untouched. */
DEM_INLINE double dem__force_alone(const dem_contact *contact, const double *state, double gap, double closing, double *elastic,
                                   const dem_law *law) {
    dem_contact c = *contact;
    dem_response r;
    double s[DEM_STATE_MAX];
    for (int k = 0; k < law->states; k++) s[k] = state[k];
    c.gap = gap < 0.0 ? gap : -DBL_MIN;
    c.closing = closing;
    c.dt = 0.0;
    law->force(&c, s, &r);
    *elastic = r.elastic;
    return r.contact;
}

/* Normal motion of the two bodies by themselves over time t, one Runge-Kutta step of fourth order. */
DEM_INLINE double dem__flow(const dem_contact *c, const double *state, double *gap, double *closing, double t, const dem_law *law) {
    double g = *gap, u = *closing, m = 1.0 / c->mass, elastic;
    double a1 = -m * dem__force_alone(c, state, g, u, &elastic, law);
    double u2 = u + 0.5 * t * a1, a2 = -m * dem__force_alone(c, state, g - 0.5 * t * u, u2, &elastic, law);
    double u3 = u + 0.5 * t * a2, a3 = -m * dem__force_alone(c, state, g - 0.5 * t * u2, u3, &elastic, law);
    double u4 = u + t * a3, a4 = -m * dem__force_alone(c, state, g - t * u3, u4, &elastic, law);
    *gap = g - t / 6.0 * (u + 2.0 * u2 + 2.0 * u3 + u4);
    *closing = u + t / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    return dem__force_alone(c, state, *gap, *closing, &elastic, law);
}

/* The first and the last step of a contact are cut: Verlet would give them a whole step's force or none. Here the two bodies' normal
   motion through such a step is followed by itself, and the difference is handed on as an impulse and a shift along the normal. A
   velocity of Verlet's is the chord over two steps of the motion that it follows: from the motion's own, a sixth of h^2 times its
   second derivative. */
typedef struct dem__event {
    double impulse, shift; /* [N s], [kg m]: divided by a mass, change of velocity and of position along n */
    double gap, closing;   /* at the end of the step */
    double duration;       /* of contact within the step [s] */
    double loss, elastic;  /* dissipated by the normal dashpot in the step, stored at its end [J] */
    double before;         /* of a contact that ends: its closing speed at the start of the step [m/s] */
} dem__event;

/* Returns 0 if there is nothing to mend. The impulse is the whole of the step's. */
DEM_INLINE int dem__begin_contact(const dem_contact *c, const double *state, dem__event *e, const dem_law *law) {
    double h = 1.0 / c->rate, t = -c->gap / c->closing, elastic;
    if (!(c->closing > 0.0)) return 0;
    e->duration = t < h ? t : h;
    e->gap = 0.0;
    e->closing = c->closing;
    dem__flow(c, state, &e->gap, &e->closing, e->duration, law);
    const double force = dem__force_alone(c, state, e->gap, e->closing, &elastic, law);
    double next = e->gap, then = e->closing;
    dem__flow(c, state, &next, &then, h, law);
    const double handed = (e->gap - next) * c->rate + 0.5 * h * force / c->mass; /* leads there within the next step */
    e->impulse = c->mass * (c->closing - handed);
    e->shift = c->mass * (e->gap - c->gap);
    e->elastic = elastic;
    e->loss = 0.5 * c->mass * (c->closing * c->closing - handed * handed) - elastic;
    return 1;
}

/* gap and force: of the step before. The closing speed is that from which Verlet, for the two bodies alone, leads to the gap of now. */
DEM_INLINE int dem__end_contact(const dem_contact *c, const double *state, double gap, double force, dem__event *e, const dem_law *law) {
    const double h = 1.0 / c->rate, half_kick = 0.5 * h * force / c->mass, verlet = (gap - c->gap) * c->rate + half_kick;
    const double speed = c->closing + 2.0 * half_kick; /* nearly the same, from velocities: sane where a wall has leapt */
    double own = speed;                                /* the motion's own: it comes along the chord of the step before */
    if (!(verlet < 0.0 && gap < 0.0)) return 0;
    for (int k = 0; k < 2; k++) {
        double back = gap, then = own;
        dem__flow(c, state, &back, &then, -h, law);
        own += speed + half_kick - (back - gap) * c->rate;
    }
    const double u = e->before = verlet + own - speed;
    double t = 0.0, g = gap, v = u, f = force, before, after;
    const int pulls = dem__force_alone(c, state, 0.0, u, &before, law) < 0.0;
    dem__force_alone(c, state, gap, u, &before, law);
    for (int k = 0; k < 3; k++) {
        double rest, last = h - t;
        if (pulls) rest = v < 0.0 ? g / v : 0.0; /* a pulling dashpot lets go when the overlap is zero */
        else {                                   /* a clipped one when the force is: follow its slope, found a moment later */
            const double moment = h / 64.0, fp = dem__force_alone(c, state, g - moment * v, v - moment * f / c->mass, &after, law);
            rest = fp < f ? moment * f / (f - fp) : last;
            if (k < 2) rest *= 0.9;
        }
        rest = rest < last ? rest : last;
        f = dem__flow(c, state, &g, &v, rest, law);
        t += rest;
    }
    e->duration = t;
    e->closing = v;
    e->gap = g - (h - t) * v;
    dem__force_alone(c, state, e->gap, v, &after, law);
    e->impulse = c->mass * (verlet - v);
    e->shift = c->mass * (e->gap - c->gap);
    e->elastic = e->gap < 0.0 ? after : 0.0;
    e->loss = before - e->elastic + 0.5 * c->mass * (verlet * verlet - v * v);
    return 1;
}

/* What is known of a block of contacts before the law is asked. */
typedef struct dem__rows {
    dem__row dx, dy, dz;             /* centre of i from that of j (wall: from the nearest point) */
    dem__row vx, vy, vz, ax, ay, az; /* relative velocity in the middle of the step, relative acceleration */
    dem__row wi[3], wj[3];           /* spins */
    dem__row nx, ny, nz, gap, inverse;
} dem__rows;

/* What is known of a contact since its birth. Kept from block to block, as most contacts are of the same kinds. */
typedef struct dem__traits {
    int32_t kind[DEM_BLOCK]; /* of which the rows are; -2: of none yet */
    dem__row mass, predict, sum, part, constant[DEM_CONSTANTS_MAX];
} dem__traits;

/* The geometry of contact k, as the law sees it. */
DEM_INLINE void dem__view(const dem__rows *b, const dem__traits *t, int k, double half, int turns, dem_contact *q, double *arm_i,
                          double *arm_j) {
    const double nx = b->nx[k], ny = b->ny[k], nz = b->nz[k];
    const double along = b->vx[k] * nx + b->vy[k] * ny + b->vz[k] * nz;
    q->normal[0] = nx, q->normal[1] = ny, q->normal[2] = nz;
    q->gap = b->gap[k];
    q->closing = -along - half * (b->ax[k] * nx + b->ay[k] * ny + b->az[k] * nz);
    if (!turns) return;
    /* arms D r_i/(r_i + r_j) add up to the distance, so that no angular momentum is made */
    const double distance = t->sum[k] + b->gap[k], ai = t->part[k] * distance, aj = (1.0 - t->part[k]) * distance;
    const double sx = ai * b->wi[0][k] + aj * b->wj[0][k], sy = ai * b->wi[1][k] + aj * b->wj[1][k],
                 sz = ai * b->wi[2][k] + aj * b->wj[2][k];
    *arm_i = ai, *arm_j = aj;
    q->translation[0] = b->vx[k] - along * nx, q->translation[1] = b->vy[k] - along * ny, q->translation[2] = b->vz[k] - along * nz;
    q->slip[0] = q->translation[0] + (ny * sz - nz * sy);
    q->slip[1] = q->translation[1] + (nz * sx - nx * sz);
    q->slip[2] = q->translation[2] + (nx * sy - ny * sx);
    q->spin[0] = b->wi[0][k] - b->wj[0][k], q->spin[1] = b->wi[1][k] - b->wj[1][k], q->spin[2] = b->wi[2][k] - b->wj[2][k];
}

/* Turns a tangential vector of the history with the contact: from the old normal to the new one, which the tangential velocity
   connects, to second order without a root; and about the normal with the mean spin. */
DEM_INLINE void dem__turn(const dem__rows *b, int k, double h, double *s) {
    const double nx = b->nx[k], ny = b->ny[k], nz = b->nz[k], by = 0.5 * h * b->inverse[k];
    const double along = b->vx[k] * nx + b->vy[k] * ny + b->vz[k] * nz;
    const double twist = 0.5 * h * ((b->wi[0][k] + b->wj[0][k]) * nx + (b->wi[1][k] + b->wj[1][k]) * ny + (b->wi[2][k] + b->wj[2][k]) * nz);
    const double x = s[0], y = s[1], z = s[2], out = x * nx + y * ny + z * nz;
    s[0] = x - out * (nx - by * (b->vx[k] - along * nx)) + twist * (ny * z - nz * y);
    s[1] = y - out * (ny - by * (b->vy[k] - along * ny)) + twist * (nz * x - nx * z);
    s[2] = z - out * (nz - by * (b->vz[k] - along * nz)) + twist * (nx * y - ny * x);
}

/* Where the slots of contacts begin: in the world, or in a block. */
typedef struct dem__slots {
    double *state[DEM_STATE_MAX], *out[9], *gap, *force, *elastic, *power[3], *loss[4];
} dem__slots;

/* What is new of a block of contacts. */
typedef struct dem__block {
    dem__row state[DEM_STATE_MAX], out[9], gap, force, elastic, power[3], loss[4];
} dem__block;

DEM_INLINE void dem__slots_of(const dem_world *w, ptrdiff_t c, const dem_law *law, int features, dem__slots *at) {
    for (int a = 0; a < law->states; a++) at->state[a] = w->live_state__[a] + c;
    for (int a = 0; a < 9; a++) at->out[a] = w->live_out__[a] + c;
    at->gap = w->live_gap__ + c, at->force = w->live_force__ + c;
    for (int a = 0; a < 3 && features & DEM_ENERGY; a++) at->power[a] = w->live_power__[a] + c;
    for (int a = 0; a < 4 && features & DEM_ENERGY; a++) at->loss[a] = w->live_loss__[a] + c;
    at->elastic = features & DEM_ENERGY ? w->live_elastic__ + c : NULL;
}

/* Where what is new of a block goes: forces into the block, as they are kept only if somebody asks. */
DEM_INLINE void dem__slots_new(const dem_world *w, ptrdiff_t c, const dem_law *law, int features, dem__block *b, dem__slots *at) {
    dem__slots_of(w, c, law, features, at);
    for (int a = 0; a < 9; a++) at->out[a] = b->out[a];
    if (!DEM__IN_ROWS) return;
    for (int a = 0; a < DEM_STATE_MAX; a++) at->state[a] = b->state[a];
    for (int a = 0; a < 3; a++) at->power[a] = b->power[a];
    for (int a = 0; a < 4; a++) at->loss[a] = b->loss[a];
    at->gap = b->gap, at->force = b->force, at->elastic = b->elastic;
}

/* From there to the world. */
DEM_INLINE void dem__store(const dem__slots *to, const dem__slots *from, int n, const dem_law *law, int features, int keeps_out) {
    const size_t bytes = (size_t)n * sizeof(double);
    for (int a = 0; a < (features & DEM_FRICTION ? 9 : 3) && keeps_out; a++) memcpy(to->out[a], from->out[a], bytes);
    if (!DEM__IN_ROWS) return;
    for (int a = 0; a < law->history; a++) memcpy(to->state[a], from->state[a], bytes);
    memcpy(to->gap, from->gap, bytes), memcpy(to->force, from->force, bytes);
    if (!(features & DEM_ENERGY)) return;
    for (int a = 0; a < 3; a++) memcpy(to->power[a], from->power[a], bytes);
    for (int a = 0; a < 4; a++) memcpy(to->loss[a], from->loss[a], bytes);
    memcpy(to->elastic, from->elastic, bytes);
}

/* Of a block in which each contact has its own. */
static inline void dem__copy_traits(const dem_world *w, ptrdiff_t base, int n, int constants, dem__traits *t) {
    const size_t bytes = (size_t)n * sizeof(double);
    memcpy(t->mass, w->live_mass__ + base, bytes), memcpy(t->predict, w->live_predict__ + base, bytes);
    memcpy(t->sum, w->live_sum__ + base, bytes), memcpy(t->part, w->live_part__ + base, bytes);
    for (int a = 0; a < constants; a++) memcpy(t->constant[a], w->live_constant__[a] + base, bytes);
    for (int k = 0; k < n; k++) t->kind[k] = -1;
}

/* Of those slots of a block whose kind is not that of before. */
static DEM__APART void dem__renew_traits(const dem_world *w, ptrdiff_t base, int n, int constants, dem__traits *t) {
    const int32_t *kind = w->live_kind__ + base;
    int32_t own = -1;
    for (int k = 0; k < n; k++) own &= kind[k];
    if (own < 0) {
        dem__copy_traits(w, base, n, constants, t);
        return;
    }
    for (int k = 0; k < n; k++) {
        const ptrdiff_t c = base + k;
        if (kind[k] >= 0 && kind[k] == t->kind[k]) continue;
        t->kind[k] = kind[k];
        if (kind[k] >= 0) {
            const dem__kind *of = &w->kind__[kind[k]];
            t->mass[k] = of->mass, t->predict[k] = of->predict, t->sum[k] = of->sum, t->part[k] = of->part;
            for (int a = 0; a < constants; a++) t->constant[a][k] = of->constant[a];
        } else {
            t->mass[k] = w->live_mass__[c], t->predict[k] = w->live_predict__[c], t->sum[k] = w->live_sum__[c],
            t->part[k] = w->live_part__[c];
            for (int a = 0; a < constants; a++) t->constant[a][k] = w->live_constant__[a][c];
        }
    }
}
DEM_INLINE void dem__take_traits(const dem_world *w, ptrdiff_t base, int n, int constants, dem__traits *t) {
    const int32_t *kind = w->live_kind__ + base;
    int32_t differ = 0;
    for (int k = 0; k < n; k++) differ |= (kind[k] ^ t->kind[k]) | kind[k] >> 31;
    if (differ) dem__renew_traits(w, base, n, constants, t);
}

/* Force on i, torques on i and j. */
DEM_INLINE void dem__put_force(double *const *out, ptrdiff_t c, const dem_contact *q, const dem_response *r, double arm_i, double arm_j,
                               int features) {
    const double nx = q->normal[0], ny = q->normal[1], nz = q->normal[2];
    if (!(features & DEM_FRICTION)) {
        out[0][c] = r->normal * nx, out[1][c] = r->normal * ny, out[2][c] = r->normal * nz;
        return;
    }
    const double tx = r->tangential[0], ty = r->tangential[1], tz = r->tangential[2];
    const double mx = ny * tz - nz * ty, my = nz * tx - nx * tz, mz = nx * ty - ny * tx;
    const double rx = features & DEM_ROLLING ? r->rolling[0] : 0.0, ry = features & DEM_ROLLING ? r->rolling[1] : 0.0;
    const double rz = features & DEM_ROLLING ? r->rolling[2] : 0.0;
    out[0][c] = r->normal * nx + tx, out[1][c] = r->normal * ny + ty, out[2][c] = r->normal * nz + tz;
    out[3][c] = rx - arm_i * mx, out[4][c] = ry - arm_i * my, out[5][c] = rz - arm_i * mz;
    out[6][c] = -rx - arm_j * mx, out[7][c] = -ry - arm_j * my, out[8][c] = -rz - arm_j * mz;
}

/* Losses of a step: powers by the trapezoidal rule. In a clipped contact that only unloads, the spring gives its energy to nobody. */
DEM_INLINE void dem__put_losses(const dem__slots *at, const dem__slots *old, ptrdiff_t c, const dem_response *r, double h,
                                double contact_before) {
    const double unloaded = old->elastic[c] - r->elastic, damped = 0.5 * h * (old->power[0][c] + r->normal_power);
    at->loss[0][c] = fabs(contact_before) + fabs(r->contact) == 0.0 ? unloaded : damped;
    at->loss[1][c] = r->slide_loss;
    at->loss[2][c] = 0.5 * h * (old->power[1][c] + r->rolling_power);
    at->power[0][c] = r->normal_power;
    at->power[1][c] = r->rolling_power;
    at->elastic[c] = r->elastic;
}

/* Where a wall is touched by the contact in a slot or, without one (-1), by a link. */
DEM_INLINE void dem__touch_place(const dem_world *w, ptrdiff_t slot, const dem_wall *wall, dem_vec x, double radius, int32_t element,
                                 dem__touch *touch) {
    if (slot >= 0 && wall->kind == DEM_MESH) {
        touch->normal = dem_vec3(w->live_place__[0][slot], w->live_place__[1][slot], w->live_place__[2][slot]);
        touch->gap = w->live_place__[3][slot];
    } else dem__touch_element(wall, x, radius, element, touch);
}

/* Where row k of a block is at a wall. */
typedef struct dem__place {
    const dem_particle *particle;
    const dem_wall *wall;
    int row;
    dem_vec from, velocity; /* the centre from its axis [m], and the wall's there [m/s] */
    double outside, inner;  /* 1, -1 inside, of a round wall, whose surface is so far from its axis; 0: elsewhere, the touch is known */
    dem__touch touch;
} dem__place;

/* Particle i at an element of a wall, for the contact in a slot or a link (-1), into row k. A round wall is like another sphere: root and
   quotient are left to dem__complete_rows. */
static DEM__APART void dem__gather_wall(const dem_world *w, ptrdiff_t i, ptrdiff_t number, int32_t element, ptrdiff_t slot, dem__rows *b,
                                        int k, double half, dem__place *at) {
    const dem_wall *wall = &w->wall[number];
    const dem_particle *s = &w->particle[i];
    at->particle = s, at->wall = wall, at->row = k, at->velocity = wall->velocity;
    at->outside = dem__reach_round(wall, s->x, element, &at->from, &at->inner);
    if (at->outside == 0.0) {
        dem__touch_place(w, slot, wall, s->x, s->radius, element, &at->touch);
        at->from = dem_vec3(s->radius + at->touch.gap, 0.0, 0.0);
    }
    b->dx[k] = at->from.x, b->dy[k] = at->from.y, b->dz[k] = at->from.z;
    b->vx[k] = s->v.x - (wall->velocity.x - half * wall->acceleration.x);
    b->vy[k] = s->v.y - (wall->velocity.y - half * wall->acceleration.y);
    b->vz[k] = s->v.z - (wall->velocity.z - half * wall->acceleration.z);
    b->ax[k] = s->a.x - wall->acceleration.x, b->ay[k] = s->a.y - wall->acceleration.y, b->az[k] = s->a.z - wall->acceleration.z;
    b->wi[0][k] = s->spin.x, b->wi[1][k] = s->spin.y, b->wi[2][k] = s->spin.z;
    b->wj[0][k] = b->wj[1][k] = b->wj[2][k] = 0.0;
}

/* The same where the wall's surface slides: at the point that is touched. */
static DEM__APART void dem__slide(dem__rows *b, double half, dem__place *at) {
    const int k = at->row;
    const dem_wall *wall = at->wall;
    const dem_particle *s = at->particle;
    const dem_vec n = dem_vec3(b->nx[k], b->ny[k], b->nz[k]), point = dem__plus(s->x, -(s->radius + b->gap[k]), n);
    const dem_vec a = dem__surface_acceleration(wall, point), spin = dem__scale(wall->spin, wall->spin_axis);
    at->velocity = dem__surface_velocity(wall, point, n);
    const dem_vec v = dem__sub(s->v, dem__plus(at->velocity, -half, a));
    b->vx[k] = v.x, b->vy[k] = v.y, b->vz[k] = v.z;
    b->ax[k] = s->a.x - a.x, b->ay[k] = s->a.y - a.y, b->az[k] = s->a.z - a.z;
    b->wj[0][k] = spin.x, b->wj[1][k] = spin.y, b->wj[2][k] = spin.z;
}

DEM_INLINE void dem__gather_pair(const dem_world *w, ptrdiff_t i, ptrdiff_t j, dem__rows *b, int k, int turns) {
    const dem_particle *p = &w->particle[i], *q = &w->particle[j];
    b->dx[k] = p->x.x - q->x.x, b->dy[k] = p->x.y - q->x.y, b->dz[k] = p->x.z - q->x.z;
    b->vx[k] = p->v.x - q->v.x, b->vy[k] = p->v.y - q->v.y, b->vz[k] = p->v.z - q->v.z;
    b->ax[k] = p->a.x - q->a.x, b->ay[k] = p->a.y - q->a.y, b->az[k] = p->a.z - q->a.z;
    if (!turns) return;
    b->wi[0][k] = p->spin.x, b->wi[1][k] = p->spin.y, b->wi[2][k] = p->spin.z;
    b->wj[0][k] = q->spin.x, b->wj[1][k] = q->spin.y, b->wj[2][k] = q->spin.z;
}

/* Of the mass of i, and of j unless it is a wall, that a contact may count on. */
DEM_INLINE double dem__share(const dem_world *w, ptrdiff_t i, ptrdiff_t j) {
    const double a = w->share__[i], b = w->share__[j < 0 ? i : j];
    return a < b ? a : b;
}

/* Nearest images; positions of active particles lie within the periodic box. */
DEM_INLINE void dem__wrap_row(double *row, int n, double length) {
    for (int k = 0; k < n; k++) row[k] = dem__image(row[k], length);
}

/* Of a wall's row. */
DEM_INLINE void dem__complete_wall(dem__rows *b, double half, dem__place *at) {
    const int k = at->row;
    const double radius = at->particle->radius;
    if (at->outside == 0.0) {
        b->nx[k] = at->touch.normal.x, b->ny[k] = at->touch.normal.y, b->nz[k] = at->touch.normal.z;
        b->gap[k] = at->touch.gap;
    } else {
        b->nx[k] *= at->outside, b->ny[k] *= at->outside, b->nz[k] *= at->outside, b->inverse[k] *= at->outside;
        b->gap[k] = at->outside * (b->gap[k] + radius - at->inner) - radius;
    }
    if (at->wall->slides) dem__slide(b, half, at);
}

/* Nearest images, normals and gaps of a block with some rows at walls. */
DEM_INLINE void dem__complete_rows(const dem_world *w, dem__rows *b, const dem__traits *t, int n, double half, dem__place *wall,
                                   int walls) {
    if (w->def.periodic[0]) dem__wrap_row(b->dx, n, w->def.high.x - w->def.low.x);
    if (w->def.periodic[1]) dem__wrap_row(b->dy, n, w->def.high.y - w->def.low.y);
    if (w->def.periodic[2]) dem__wrap_row(b->dz, n, w->def.high.z - w->def.low.z);
    for (int q = 0; q < walls && w->has_periodic__; q++) { /* walls have no images */
        const int k = wall[q].row;
        b->dx[k] = wall[q].from.x, b->dy[k] = wall[q].from.y, b->dz[k] = wall[q].from.z;
    }
    for (int k = 0; k < n; k++) {
        const double distance = sqrt(b->dx[k] * b->dx[k] + b->dy[k] * b->dy[k] + b->dz[k] * b->dz[k]), inverse = 1.0 / distance;
        b->nx[k] = b->dx[k] * inverse, b->ny[k] = b->dy[k] * inverse, b->nz[k] = b->dz[k] * inverse;
        b->inverse[k] = inverse;
        b->gap[k] = distance - t->sum[k];
    }
    for (int q = 0; q < walls; q++) dem__complete_wall(b, half, &wall[q]);
}

/* A contact that begins or ends within a step: what it was at the start, where its force at the end goes, and the wall's velocity. */
typedef struct dem__verge {
    double gap, force, state[DEM_STATE_MAX], *out[9], arm_i, arm_j;
    dem_vec wall_speed;
} dem__verge;

/* Adds to an impulse what friction and rolling do as they are in r: in a time, and in one that follows from a normal impulse over the force
   of the contact. That may be next to nothing, so what would remain without it has no part there. */
DEM_INLINE void dem__act_for(dem_response *impulse, const dem_response *r, double time, double scaled, int features) {
    for (int a = 0; a < 3; a++) {
        impulse->tangential[a] += (time + scaled) * r->tangential[a] - scaled * r->remaining[a];
        impulse->rolling[a] += features & DEM_ROLLING ? (time + scaled) * r->rolling[a] : 0.0;
    }
}

/* Friction within the step in which a contact begins, from what it is after a third of the time t and at the end, r (Radau); what the
   normal impulse has beyond its own t, because Verlet's velocities are chords, friction has in proportion. */
DEM_INLINE void dem__begin_friction(const dem_contact *touch, const dem__event *e, double *s, const dem_response *r, dem_response *impulse,
                                    const dem_law *law, int features) {
    const double t = e->duration, beyond = e->impulse - touch->mass * (touch->closing - e->closing);
    dem_response third;
    memset(&third, 0, sizeof third);
    dem_contact q = *touch;
    q.gap = (7.0 * e->gap - t * (4.0 * touch->closing - 2.0 * e->closing)) / 27.0; /* of the cubic from end to end */
    q.closing = t > 0.0 ? -4.0 / 3.0 * e->gap / t - e->closing / 3.0 : touch->closing;
    q.dt = t / 3.0;
    law->force(&q, s, &third);
    dem__act_for(impulse, &third, 0.75 * t, 0.0, features);
    dem__act_for(impulse, r, 0.25 * t, r->contact > 0.0 ? beyond / r->contact : 0.0, features);
}

/* What a first or last step hands over: impulses, the normal force that the next step starts from, the work of the wall by friction. */
typedef struct dem__mended {
    dem__event e;
    dem_response impulse; /* in the end beside the half steps that Verlet hands over */
    double start, driven;
} dem__mended;

/* The step in which a contact begins, from history s: force, history and losses. 0: it does not begin. */
DEM_INLINE int dem__mend_first(dem_contact *q, double *s, const dem__slots *at, const dem__verge *was, const dem_law *law, int features,
                               dem__mended *m) {
    const double half = 0.5 / q->rate;
    dem_response r;
    memset(&r, 0, sizeof r);
    if (!dem__begin_contact(q, s, &m->e, law)) return 0;
    const dem_contact touch = *q;
    q->gap = m->e.gap;
    q->closing = m->e.closing;
    q->dt = m->e.duration;
    law->force(q, s, &r);
    for (int a = 0; a < law->history; a++) at->state[a][0] = s[a];
    dem__put_force(was->out, 0, q, &r, was->arm_i, was->arm_j, features);
    at->force[0] = m->start = r.contact;
    if (features & DEM_FRICTION) {
        for (int a = 0; a < law->history; a++) s[a] = 0.0;
        dem__begin_friction(&touch, &m->e, s, &r, &m->impulse, law, features);
        const dem_vec friction = dem__first(m->impulse.tangential);
        m->driven = dem__dot(friction, was->wall_speed);
        r.slide_loss = -dem__dot(friction, dem__first(q->slip)) - (r.elastic - m->e.elastic);
        dem__act_for(&m->impulse, &r, -half, 0.0, features);
    }
    if (features & DEM_ENERGY) {
        const double film = r.normal > r.contact ? r.normal - r.contact : 0.0; /* acts half a step, as forces of Verlet's do */
        dem__put_losses(at, at, 0, &r, 0.0, 1.0);
        at->loss[2][0] = half * film * q->closing;
    }
    return 1;
}

/* The step in which it ends, likewise. 0: Verlet's step stands. */
DEM_INLINE int dem__mend_last(dem_contact *q, double *s, const dem__slots *at, const dem__verge *was, const dem_law *law, int features,
                              dem__mended *m) {
    const double half = 0.5 / q->rate;
    dem_response r;
    memset(&r, 0, sizeof r);
    if (!dem__end_contact(q, s, was->gap, was->force, &m->e, law)) return 0;
    if (m->e.gap < 0.0) {
        q->gap = m->e.gap;
        q->closing = m->e.closing;
        law->force(q, s, &r);
        if (r.contact < 0.0) { /* Verlet would end it a moment too soon, while the dashpot still pulls */
            dem__put_force(was->out, 0, q, &r, was->arm_i, was->arm_j, features);
            at->force[0] = m->start = r.contact;
            if (features & DEM_ENERGY) dem__put_losses(at, at, 0, &r, 0.0, 1.0);
        }
    }
    if ((features & DEM_FRICTION) && m->start == 0.0) { /* friction fades with the normal force */
        for (int a = 0; a < law->states; a++) s[a] = was->state[a];
        q->gap = was->gap;
        q->closing = m->e.before;
        law->force(q, s, &r);
        dem__act_for(&m->impulse, &r, 0.0, r.contact > 0.0 ? m->e.impulse / r.contact - half : 0.0, features);
        m->driven = dem__dot(dem__plus(dem__first(m->impulse.tangential), half, dem__first(r.tangential)), was->wall_speed);
        if (features & DEM_ENERGY) at->loss[1][0] -= dem__dot(dem__first(m->impulse.tangential), dem__first(q->slip));
    }
    return 1;
}

/* Mends a first or last step of the contact in slot c, and leaves impulses and shift for the end of the step. */
DEM_INLINE void dem__mend(dem_world *w, ptrdiff_t c, dem_contact *q, const dem__verge *was, const dem_law *law, int features) {
    const int first = was->force == 0.0;
    dem__slots at;
    dem__mended m;
    double s[DEM_STATE_MAX], *impulse[9];
    dem__handed *handed = &w->live_handed__[c];
    memset(&m, 0, sizeof m);
    dem__slots_of(w, c, law, features, &at);
    for (int a = 0; a < law->states; a++) s[a] = first && a < law->history ? 0.0 : at.state[a][0];
    const int mended = first ? dem__mend_first(q, s, &at, was, law, features, &m) : dem__mend_last(q, s, &at, was, law, features, &m);
    w->live_event__[c] = mended != 0;
    if (!mended) return;
    if (!first && m.start != 0.0) w->live_ended__[c] = 0;
    at.gap[0] = m.e.gap;
    m.impulse.normal = m.e.impulse - 0.5 / q->rate * (was->force + m.start);
    for (int a = 0; a < 3; a++) handed->n[a] = q->normal[a];
    handed->shift = m.e.shift;
    for (int a = 0; a < 9; a++) impulse[a] = &handed->impulse[a];
    dem__put_force(impulse, 0, q, &m.impulse, was->arm_i, was->arm_j, features);
    if (!(features & DEM_ENERGY)) return;
    at.loss[0][0] = m.e.loss;
    if (!first) at.elastic[0] = m.e.elastic;
    at.loss[3][0] = m.e.impulse * dem__dot(dem__first(q->normal), was->wall_speed) + m.driven;
    at.power[2][0] = m.start != 0.0 ? dem__dot(dem_vec3(was->out[0][0], was->out[1][0], was->out[2][0]), was->wall_speed) : 0.0;
}

typedef void dem__mend_fn(dem_world *w, ptrdiff_t c, dem_contact *q, const dem__verge *was);

/* Did a contact begin or end in this step, by its forces and the gap before? All bits: choices would keep the loop scalar. */
DEM_INLINE int64_t dem__began_or_ended(double before, double now, double gap_before) {
    const int64_t idle = before == 0.0;
    return (idle ^ (int64_t)(now == 0.0)) & ((idle ^ 1) | (int64_t)(gap_before > 0.0));
}

/* Marks and lists such contacts of a section, and those whose law has ended, in the block from slot base on. How many? */
DEM_INLINE ptrdiff_t dem__mark(dem_world *w, dem__section *in, ptrdiff_t base, int n, const double *before, const double *was,
                               const double *ended, const double *force) {
    const ptrdiff_t marked = in->marked;
    int64_t mark[DEM_BLOCK], any = 0;
    for (int k = 0; k < n; k++) {
        mark[k] = dem__began_or_ended(before[k], force[k], was[k]) | (int64_t)(ended[k] != 0.0) << 1;
        any |= mark[k];
    }
    for (int k = 0; k < n && any; k++) {
        if (!mark[k]) continue;
        w->live_event__[base + k] = (uint8_t)(mark[k] & 1);
        w->live_ended__[base + k] = (uint8_t)(mark[k] >> 1);
        w->slots__[in->first + in->marked++] = (int32_t)(base + k);
    }
    return in->marked - marked;
}

DEM_INLINE void dem__add_load(dem__sum *sum, const double *load, int turns) {
    for (int a = 0; a < (turns ? 6 : 3); a++) sum->load[a] += load[a];
}

/* Adds what a contact in section q does, force on i and torques on i and j in out[][k]: to the sum of i, to that of j or of a wall. */
DEM_INLINE void dem__add_forces(dem_world *w, ptrdiff_t q, int32_t i, int32_t j, double *const *out, ptrdiff_t k, int turns, int to_i,
                                int to_j) {
    const double fx = out[0][k], fy = out[1][k], fz = out[2][k];
    const double on_i[6] = {fx, fy, fz, turns ? out[3][k] : 0.0, turns ? out[4][k] : 0.0, turns ? out[5][k] : 0.0};
    const double on_j[6] = {-fx, -fy, -fz, turns ? out[6][k] : 0.0, turns ? out[7][k] : 0.0, turns ? out[8][k] : 0.0};
    if (to_i) dem__add_load(&w->sum__[i], on_i, turns);
    if (!to_j) return;
    if (j >= 0) {
        dem__add_load(&w->sum__[j], on_j, turns);
        return;
    }
    dem__push *push = &w->push__[q][-1 - j];
    const dem_vec f = dem_vec3(on_j[0], on_j[1], on_j[2]), t = dem_vec3(on_i[3], on_i[4], on_i[5]);
    const dem_vec arm = dem__sub(w->particle[i].x, w->wall[-1 - j].position);
    push->force = dem__add(push->force, f);
    push->torque = dem__add(push->torque, dem__sub(dem__cross(arm, f), t));
}

/* Adds what n contacts of section q do, slot by slot, in the order of which sums are; leaves to dem__add_deferred what must wait for other
   threads. */
DEM_INLINE void dem__gather_forces(dem_world *w, ptrdiff_t q, ptrdiff_t base, int n, double *const *out, int turns) {
    dem__section *in = &w->section__[q];
    const int32_t own = in->own;
    int waits = 0;
    for (int k = 0; k < n; k++) waits |= (w->live_i__[base + k] >= own) | (w->live_j__[base + k] >= own);
    for (int k = 0; k < n && !waits; k++) dem__add_forces(w, q, w->live_i__[base + k], w->live_j__[base + k], out, k, turns, 1, 1);
    for (int k = 0; k < n && waits; k++) {
        const int32_t i = w->live_i__[base + k], j = w->live_j__[base + k], last = j > i ? j : i; /* a wall's j is less than 0 */
        dem__add_forces(w, q, i, j, out, k, turns, i < own, j < own);
        if (last < own) continue;
        dem__deferral *later = &w->deferral__[in->first + in->deferred++];
        for (int a = 0; a < (turns ? 9 : 3); a++) later->out[a] = out[a][k];
        later->i = i, later->j = j;
        const int32_t first = i < own ? j : i;
        in->low = first < in->low ? first : in->low, in->high = last > in->high ? last : in->high;
    }
}

/* Ahead of a link or a contact; of a wall (less than 0) nothing needs to be asked for. */
DEM_INLINE void dem__fetch_particle(const dem_world *w, ptrdiff_t j) {
    const dem_particle *p = &w->particle[j < 0 ? 0 : j];
    DEM__PREFETCH(&p->x);
    DEM__PREFETCH(&p->a);
}
DEM_INLINE void dem__fetch_partner(const dem_world *w, ptrdiff_t j) {
    dem__fetch_particle(w, j);
    DEM__PREFETCH(&w->sum__[j < 0 ? 0 : j]);
}

DEM_INLINE void dem__fetch_contact(const dem_world *w, ptrdiff_t c) {
    dem__fetch_partner(w, w->live_i__[c]);
    dem__fetch_partner(w, w->live_j__[c]);
}

/* Evaluates the contacts of a section. Each stands alone: what it reads is of its own slot and of particles and walls that do not change
   meanwhile, what it writes is of its own slot; hence any division among threads gives the same bits. Each block is summed while it is in
   the cache. */
DEM_INLINE void dem__evaluate_section(dem_world *w, ptrdiff_t section, dem__traits *traits, const dem_law *law, dem__mend_fn *mend,
                                      int features) {
    const int turns = (features & DEM_FRICTION) != 0;
    const double h = w->kernel_dt__, rate = 1.0 / w->dt__, half = 0.5 * h;
    const void *user = w->user;
    dem__section *in = &w->section__[section];
    const ptrdiff_t end = in->first + in->live;
    dem__rows b;
    dem__block block;
    for (ptrdiff_t base = in->first; base < end; base += DEM_BLOCK) {
        const int n = end - base < DEM_BLOCK ? (int)(end - base) : DEM_BLOCK;
        dem__place wall[DEM_BLOCK];
        int walls = 0;

        /* the next block, of this section or of the one after it, is asked for ahead */
        const dem__section *then = base + DEM_BLOCK < end || section + 1 == w->sections__ ? in : in + 1;
        const ptrdiff_t ahead = then == in ? base + DEM_BLOCK : then->first, stop = then->first + then->live;
        for (int k = 0; k < n; k++) {
            const ptrdiff_t c = base + k, i = w->live_i__[c], j = w->live_j__[c];
            if (ahead + k < stop) dem__fetch_contact(w, ahead + k);
            if (j >= 0) dem__gather_pair(w, i, j, &b, k, turns);
            else dem__gather_wall(w, i, -1 - j, w->live_element__[c], c, &b, k, half, &wall[walls++]);
        }
        for (int k = n; k < DEM_BLOCK && ahead + k < stop; k++) dem__fetch_contact(w, ahead + k);
        dem__take_traits(w, base, n, law->constants, traits);
        dem__complete_rows(w, &b, traits, n, half, wall, walls);
        dem__row share; /* by itself, so that it is not even computed for a law that does not ask for it */
        for (int k = 0; k < n; k++) share[k] = dem__share(w, w->live_i__[base + k], w->live_j__[base + k]);

        dem__row before, was, ended, past[DEM_STATE_MAX];
        dem__slots old, at;
        dem__slots_of(w, base, law, features, &old);
        dem__slots_new(w, base, law, features, &block, &at);
        DEM__INDEPENDENT
        for (int k = 0; k < n; k++) {
            dem_contact q;
            dem_response r;
            double s[DEM_STATE_MAX], p[DEM_CONSTANTS_MAX], arm_i = 0.0, arm_j = 0.0;
            for (int a = 0; a < law->constants; a++) p[a] = traits->constant[a][k];
            for (int a = 0; a < law->states; a++) s[a] = old.state[a][k];
            for (int a = 0; a < law->vectors; a++) dem__turn(&b, k, h, s + 3 * a);
            for (int a = 0; a < law->history && turns; a++) past[a][k] = s[a];
            dem__view(&b, traits, k, half, turns, &q, &arm_i, &arm_j);
            const double predict = traits->predict[k]; /* read outside the choice, or the loop does not vectorise */
            q.closing *= b.gap[k] < 0.0 ? predict : 1.0;
            q.mass = traits->mass[k];
            q.share = share[k];
            q.dt = h;
            q.rate = rate;
            q.constants = p;
            q.user = user;
            law->force(&q, s, &r);
            for (int a = 0; a < law->history; a++) at.state[a][k] = s[a];
            before[k] = old.force[k], was[k] = old.gap[k], ended[k] = r.ended;
            at.force[k] = r.contact;
            at.gap[k] = b.gap[k];
            dem__put_force(at.out, k, &q, &r, arm_i, arm_j, features);
            if (features & DEM_ENERGY) {
                r.normal_power *= 1.0 - (1.0 - predict) / 11.0; /* its work along a step: k/24 less; predict is 1 - 11 k/24 */
                dem__put_losses(&at, &old, k, &r, h, before[k]);
            }
        }
        const ptrdiff_t marked = dem__mark(w, in, base, n, before, was, ended, at.force);
        if (features & DEM_ENERGY) {
            for (int k = 0; k < n; k++) at.loss[3][k] = 0.0, at.power[2][k] = old.power[2][k];
            for (int q = 0; q < walls; q++) {
                const int k = wall[q].row;
                const dem_vec v = wall[q].velocity;
                const double power = at.out[0][k] * v.x + at.out[1][k] * v.y + at.out[2][k] * v.z;
                at.loss[3][k] = half * (old.power[2][k] + power);
                at.power[2][k] = power;
            }
        }
        dem__store(&old, &at, n, law, features, w->keeps_out__);
        for (ptrdiff_t m = in->marked - marked, q = 0; m < in->marked && h > 0.0; m++) {
            const ptrdiff_t c = w->slots__[in->first + m];
            const int k = (int)(c - base);
            dem_contact view;
            dem__verge verge;
            double p[DEM_CONSTANTS_MAX];
            if (!w->live_event__[c]) continue;
            while (q < walls && wall[q].row < k) q++;
            for (int a = 0; a < law->constants; a++) p[a] = traits->constant[a][k];
            dem__view(&b, traits, k, half, turns, &view, &verge.arm_i, &verge.arm_j);
            view.mass = traits->mass[k];
            view.share = dem__share(w, w->live_i__[c], w->live_j__[c]); /* not the row: see there */
            view.dt = 0.0;
            view.rate = rate;
            view.constants = p;
            view.user = user;
            verge.gap = was[k], verge.force = before[k];
            for (int a = 0; a < law->states && turns; a++) verge.state[a] = a < law->history ? past[a][k] : old.state[a][k];
            for (int a = 0; a < 9; a++) verge.out[a] = at.out[a] + k;
            verge.wall_speed = w->live_j__[c] < 0 ? wall[q].velocity : dem_vec3(0.0, 0.0, 0.0);
            mend(w, c, &view, &verge);
            for (int a = 0; a < (turns ? 9 : 3) && w->keeps_out__; a++) old.out[a][k] = at.out[a][k];
        }
        dem__gather_forces(w, section, base, n, at.out, turns);
    }
}

/* Is a kernel of these features the one for a run with those? The arrays of the ledger must be there, or not. */
DEM_INLINE int dem__serves(int features, int run) {
    return (features & DEM_ENERGY) == (run & DEM_ENERGY) && !(run & ~features & (DEM_FRICTION | DEM_ROLLING));
}

/* The contacts of sections first .. end-1, by one thread. */
DEM_INLINE void dem_kernel(dem_world *w, ptrdiff_t first, ptrdiff_t end, const dem_law *law, dem__mend_fn *mend, int features) {
    dem__traits traits;
    if (!dem__serves(features, w->features__) || law->states != w->law__->states || law->constants != w->law__->constants) {
        w->status = DEM_BAD_ARGUMENT;
        return;
    }
    for (int k = 0; k < DEM_BLOCK; k++) traits.kind[k] = -2;
    for (ptrdiff_t q = first; q < end; q++) {
        w->section__[q].marked = w->section__[q].deferred = 0;
        w->section__[q].low = INT32_MAX, w->section__[q].high = 0;
        memset(w->push__[q], 0, (size_t)w->walls * sizeof *w->push__[q]);
        dem__evaluate_section(w, q, &traits, law, mend, features);
    }
}

/* Adds what links first .. end-1 do to the loads of their bodies, in their order. */
DEM_INLINE void dem__add_links(dem_world *w, ptrdiff_t first, ptrdiff_t end) {
    double *const *out = w->link_out__;
    for (ptrdiff_t k = first; k < end; k++) {
        const ptrdiff_t i = w->link_i__[k], j = w->link_j__[k], ahead = k + DEM__AHEAD;
        if (ahead < end) {
            DEM__PREFETCH(w->load__[w->link_i__[ahead]]);
            DEM__PREFETCH(w->load__[w->link_j__[ahead] < 0 ? 0 : w->link_j__[ahead]]);
        }
        if (w->link_ended__[k]) continue;
        for (int a = 0; a < 6; a++) w->load__[i][a] += out[a][k];
        if (j < 0) continue;
        for (int a = 0; a < 3; a++) w->load__[j][a] -= out[a][k];
        for (int a = 3; a < 6; a++) w->load__[j][a] += out[3 + a][k];
    }
}

/* The links in slots first .. end-1, from where everything is now. A thread that is alone adds up each block while it is in the cache. */
DEM_INLINE void dem_link_kernel(dem_world *w, ptrdiff_t first, ptrdiff_t end, const dem_law *law) {
    const double h = w->kernel_dt__;
    const void *user = w->user;
    dem__rows b;
    dem__traits traits; /* of which links have sizes only */
    dem__row state[DEM_STATE_MAX], out[9];
    for (ptrdiff_t base = first; base < end; base += DEM_BLOCK) {
        const int n = end - base < DEM_BLOCK ? (int)(end - base) : DEM_BLOCK;
        dem__place wall[DEM_BLOCK];
        int walls = 0;
        for (int k = 0; k < n; k++) {
            const ptrdiff_t c = base + k, i = w->link_i__[c], j = w->link_j__[c], ahead = c + DEM__AHEAD;
            if (ahead < end) dem__fetch_particle(w, w->link_i__[ahead]), dem__fetch_particle(w, w->link_j__[ahead]);
            if (j >= 0) dem__gather_pair(w, i, j, &b, k, 1);
            else dem__gather_wall(w, i, -1 - j, w->link_element__[c], -1, &b, k, 0.0, &wall[walls++]);
            traits.sum[k] = w->particle[i].radius + (j >= 0 ? w->particle[j].radius : 0.0);
            traits.part[k] = w->particle[i].radius / traits.sum[k];
        }
        dem__complete_rows(w, &b, &traits, n, 0.0, wall, walls);

        dem__row ended, share;
        dem__slots old, at;
        for (int a = 0; a < law->states; a++) old.state[a] = w->link_state__[a] + base;
        for (int a = 0; a < 9; a++) old.out[a] = w->link_out__[a] + base;
        for (int a = 0; a < law->states; a++) at.state[a] = DEM__IN_ROWS ? state[a] : old.state[a];
        for (int a = 0; a < 9; a++) at.out[a] = DEM__IN_ROWS ? out[a] : old.out[a];
        for (int k = 0; k < n; k++) share[k] = dem__share(w, w->link_i__[base + k], w->link_j__[base + k]);
        DEM__INDEPENDENT
        for (int k = 0; k < n; k++) {
            dem_contact q;
            dem_response r;
            double s[DEM_STATE_MAX], arm_i = 0.0, arm_j = 0.0;
            for (int a = 0; a < law->states; a++) s[a] = old.state[a][k];
            for (int a = 0; a < law->vectors; a++) dem__turn(&b, k, h, s + 3 * a);
            dem__view(&b, &traits, k, 0.0, 1, &q, &arm_i, &arm_j);
            q.mass = 0.0;
            q.share = share[k];
            q.dt = h;
            q.rate = 1.0 / h;
            q.constants = NULL;
            q.user = user;
            law->force(&q, s, &r);
            for (int a = 0; a < law->history; a++) at.state[a][k] = s[a];
            ended[k] = r.ended;
            dem__put_force(at.out, k, &q, &r, arm_i, arm_j, DEM_FRICTION);
        }
        const size_t bytes = (size_t)n * sizeof(double);
        for (int a = 0; a < law->history && DEM__IN_ROWS; a++) memcpy(old.state[a], at.state[a], bytes);
        for (int a = 0; a < 9 && DEM__IN_ROWS; a++) memcpy(old.out[a], at.out[a], bytes);
        memcpy(w->link_gap__ + base, b.gap, bytes);
        for (int k = 0; k < n; k++) w->link_ended__[base + k] = ended[k] != 0.0;
        if (dem__parts(w, w->link_count__) == 1) dem__add_links(w, base, base + n);
    }
}

#define DEM__KERNEL(name, call) DEM__TWICE(name, (dem_world * world, ptrdiff_t first, ptrdiff_t end), (world, first, end), call)
#define DEM_KERNEL(name, law, features)                                                                                                    \
    DEM__FAST static DEM__APART void name##_mend(dem_world *world, ptrdiff_t c, dem_contact *q, const dem__verge *was) {                   \
        dem__mend(world, c, q, was, &(law), features);                                                                                     \
    }                                                                                                                                      \
    DEM__KERNEL(name, dem_kernel(world, first, end, &(law), name##_mend, features))
#define DEM_LINK_KERNEL(name, law) DEM__KERNEL(name, dem_link_kernel(world, first, end, &(law)))

/* -------------------------------------------------------------------------------------------------- >>step */

static inline void dem__drop(dem_world *w, ptrdiff_t i, int wall) {
    double tau = (double)(w->step + 1 - w->particle[i].origin) * w->dt__;
    dem_vec x = dem__at(w, i, tau), v = dem__velocity_at(w, i, tau);
    if (w->alive[i] < 0) { /* it passed another exit in the same step: the first of them counts, whatever the order of the looks */
        ptrdiff_t k = w->passed_count - 1;
        while (w->passed[k].id != w->id[i]) k--;
        if (wall < w->passed[k].exit) w->passed[k].exit = wall;
        return;
    }
    if (w->passed_count >= w->passed_capacity__) {
        ptrdiff_t larger = w->passed_capacity__ * 2 + 256;
        dem_passed *fresh = (dem_passed *)w->def.allocator.fn(w->def.allocator.user, w->passed,
                                                              (size_t)w->passed_capacity__ * sizeof *fresh, (size_t)larger * sizeof *fresh);
        if (!fresh) {
            w->status = DEM_OUT_OF_MEMORY;
            return;
        }
        w->passed = fresh;
        w->passed_capacity__ = larger;
    }
    /* in the order of ids, whatever the order of the looks in this step */
    double time = w->start_time__ + (double)(w->step + 1 - w->start_step__) * w->dt__;
    ptrdiff_t at = w->passed_count++;
    for (; at > 0 && w->passed[at - 1].time == time && w->passed[at - 1].id > w->id[i]; at--) w->passed[at] = w->passed[at - 1];
    dem_passed *p = &w->passed[at];
    p->time = time;
    p->diameter = 2.0 * w->particle[i].radius;
    p->position = x;
    p->velocity = v;
    p->id = w->id[i];
    p->group = w->group[i];
    p->exit = wall;
    w->alive[i] = -1; /* leaves at the end of the step */
    w->leaving__ = 1;
}

static inline void dem__unlist_link(dem_world *w, int32_t k, int32_t i, int32_t replacement) {
    int32_t *at = &w->link_head__[i];
    while (*at != k) at = w->link_i__[*at] == i ? &w->link_next_i__[*at] : &w->link_next_j__[*at];
    *at = replacement >= 0 ? replacement : dem__next_link(w, k, i);
}

/* The last of a particle's links by slot: the order of its list depends on what has happened. */
static inline int32_t dem__last_link(const dem_world *w, ptrdiff_t i) {
    int32_t last = -1;
    for (int32_t k = w->link_head__[i]; k >= 0; k = dem__next_link(w, k, i)) last = k > last ? k : last;
    return last;
}

/* Ends a link; the last one takes its slot. Its force stays until links are evaluated next. */
static inline void dem__cut_link(dem_world *w, int32_t k) {
    const int32_t i = w->link_i__[k], j = w->link_j__[k], last = (int32_t)w->link_count__ - 1;
    if (w->link_law__ && w->link_law__->ended) w->link_law__->ended(w, k, w->user);
    dem__unlist_link(w, k, i, -1);
    if (j >= 0) {
        const int32_t p = dem__near_pair(w, i, j);
        dem__mark_link(w, p, 0);
        dem__unlist_link(w, k, j, -1);
    }
    w->link_count__ = last;
    if (k == last) return;
    dem__unlist_link(w, last, w->link_i__[last], k);
    if (w->link_j__[last] >= 0) dem__unlist_link(w, last, w->link_j__[last], k);
    dem__array list[DEM__ARRAYS_MAX];
    const int n = dem__link_arrays(w, list);
    for (int a = 0; a < n; a++) {
        char *base;
        memcpy(&base, list[a].address, sizeof base);
        memcpy(base + (size_t)k * list[a].size, base + (size_t)last * list[a].size, list[a].size);
    }
}

/* An active particle that dem__watch shall see to. */
DEM_INLINE void dem__unsettle(dem_world *w, ptrdiff_t i) {
    if (w->is_active__[i] != 1) return;
    w->is_active__[i] = 2;
    w->unsettled__[w->unsettled_count__++] = (int32_t)i;
}

/* Takes particle i out of all lists; its slot goes with the next rebuild. */
static inline void dem__forget(dem_world *w, ptrdiff_t i) {
    if (w->ledger_on__) {
        w->ledger__.link_work += dem__link_work(w, i);
        w->ledger__.removed += dem__kinetic(w, i) + dem__rotational(w, i) + dem__potential(w, i);
        w->ledger__.removed_potential += dem__potential(w, i);
    }
    while (w->link_head__[i] >= 0) dem__cut_link(w, dem__last_link(w, i));
    w->alive[i] = 0;
    w->dropped__++;
    dem__unsettle(w, i);
    if (w->stale__) return;
    for (int32_t a = w->adjacent_start__[i]; a < w->adjacent_start__[i + 1]; a++) {
        dem__stop_timer(&w->pair_timers__, w->adjacent__[2 * a]);
    }
    for (int k = 0; k < w->walls; k++) dem__stop_timer(&w->wall_timers__, (int32_t)i * w->walls + k);
}

static inline void dem__bury(dem_world *w, int64_t step, int all);

/* After others have been taken out: whoever touched nothing else is in flight, without the force of then. */
static inline void dem__let_go(dem_world *w) {
    for (ptrdiff_t k = 0; k < w->active_count__; k++) {
        if (!w->touching[w->active__[k]]) dem__free_acceleration(w, w->active__[k]);
    }
}

/* Ends the contacts of those who have been taken out. */
static inline void dem__leave_alone(dem_world *w) {
    DEM__EACH(w, c) {
        const int32_t j = w->live_j__[c];
        if (!w->alive[w->live_i__[c]] || (j >= 0 && !w->alive[j])) w->live_ended__[c] = 1;
    }
    w->stale__ = w->fresh__ = 1;
    dem__bury(w, w->step, 1);
    dem__let_go(w);
}

DEM_API dem_status dem_remove(dem_world *world, ptrdiff_t i) {
    dem_world *w = world;
    if (!dem__is_present(w, i)) return DEM_BAD_ARGUMENT;
    dem__forget(w, i);
    dem__leave_alone(w);
    return DEM_OK;
}

DEM_API dem_status dem_set_links(dem_world *world, const dem_law *law, dem_kernel_fn kernel, double interval, double near) {
    dem_world *w = world;
    if (!w || !w->def.allocator.fn || !law || !law->force || !kernel || !dem__positive(interval) || !dem__not_negative(near))
        return DEM_BAD_ARGUMENT;
    if (law->states < 0 || law->states > DEM_STATE_MAX || law->vectors < 0 || 3 * law->vectors > law->history || law->history > law->states)
        return DEM_BAD_ARGUMENT;
    if (w->link_count__ > 0 && law->states != w->link_states__) return DEM_LAW_MISMATCH;
    w->links_on__ = 1;
    w->link_law__ = law;
    w->link_kernel__ = kernel;
    w->link_interval__ = interval;
    if (w->link_near__ != near) w->stale__ = 1;
    w->link_near__ = near;
    if (law->states != w->link_states__) { /* other arrays: a new block when there is a link */
        if (w->link_block__) w->def.allocator.fn(w->def.allocator.user, w->link_block__, w->link_bytes__, 0);
        w->link_block__ = NULL;
        w->link_capacity__ = 0;
        w->link_states__ = law->states;
    }
    dem__set_stride(w);
    return DEM_OK;
}

DEM_API dem_status dem_add_link(dem_world *world, ptrdiff_t i, ptrdiff_t j, int32_t element, const double *state) {
    dem_world *w = world;
    if (!dem__is_present(w, i) || !w->link_law__ || (!state && w->link_states__ > 0) || i == j) return DEM_BAD_ARGUMENT;
    if (j >= 0 ? !dem__is_present(w, j) : -1 - j >= w->walls) return DEM_BAD_ARGUMENT;
    if (w->link_count__ + 1 > w->link_capacity__) {
        dem__array list[DEM__ARRAYS_MAX];
        if (w->link_count__ > INT32_MAX / 2 || !dem__grow_group(w, list, dem__link_arrays(w, list), &w->link_block__, &w->link_bytes__,
                                                                &w->link_capacity__, w->link_count__ + 1))
            return DEM_OUT_OF_MEMORY;
    }
    const int32_t k = (int32_t)w->link_count__++;
    w->link_i__[k] = (int32_t)i, w->link_j__[k] = (int32_t)j, w->link_element__[k] = element;
    for (int a = 0; a < w->link_states__; a++) w->link_state__[a][k] = state[a];
    for (int a = 0; a < 9; a++) w->link_out__[a][k] = 0.0;
    w->link_gap__[k] = 0.0;
    w->link_ended__[k] = 0;
    dem__list_link(w, k);
    return DEM_OK;
}

/* Order of contacts: by i, the last first, then j (walls last), then element. */
DEM_INLINE int dem__before(const dem_world *w, int32_t a, int32_t b) {
    if (w->live_i__[a] != w->live_i__[b]) return w->live_i__[a] > w->live_i__[b];
    int64_t ja = w->live_j__[a], jb = w->live_j__[b];
    ja = ja < 0 ? INT32_MAX - ja : ja, jb = jb < 0 ? INT32_MAX - jb : jb;
    if (ja != jb) return ja < jb;
    return w->live_element__[a] < w->live_element__[b];
}

static inline void dem__sift(const dem_world *w, int32_t *heap, ptrdiff_t root, ptrdiff_t n) {
    for (;;) {
        ptrdiff_t child = 2 * root + 1;
        if (child >= n) return;
        if (child + 1 < n && dem__before(w, heap[child], heap[child + 1])) child++;
        if (!dem__before(w, heap[root], heap[child])) return;
        int32_t t = heap[root];
        heap[root] = heap[child], heap[child] = t;
        root = child;
    }
}

static inline void dem__sort(const dem_world *w, int32_t *slots, ptrdiff_t n) {
    for (ptrdiff_t k = n / 2 - 1; k >= 0; k--) dem__sift(w, slots, k, n);
    for (ptrdiff_t k = n - 1; k > 0; k--) {
        int32_t t = slots[0];
        slots[0] = slots[k], slots[k] = t;
        dem__sift(w, slots, 0, k);
    }
}

/* The slots of contacts that have ended, into slots__: of those that the last step marked, or of all. */
static inline ptrdiff_t dem__list_ended(dem_world *w, int all) {
    ptrdiff_t n = 0;
    for (const dem__section *in = w->section__; in < w->section__ + w->sections__; in++) {
        for (ptrdiff_t k = 0; k < (all ? in->live : in->marked); k++) {
            const ptrdiff_t c = all ? in->first + k : w->slots__[in->first + k];
            if (w->live_ended__[c]) w->slots__[n++] = (int32_t)c;
        }
    }
    return n;
}

/* One element of an array, most often a double or 32 bits. */
DEM_INLINE void dem__copy(char *to, const char *from, size_t size) {
    if (size == 8) memcpy(to, from, 8);
    else if (size == 4) memcpy(to, from, 4);
    else *to = *from;
}

/* The n elements of an array that `from` lists, one after the other. */
static inline void dem__pick(char *to, const char *base, size_t size, const int32_t *from, ptrdiff_t n) {
    for (ptrdiff_t k = 0; k < n; k++) dem__copy(to + (size_t)k * size, base + (size_t)from[k] * size, size);
}

/* What the slots hold that slots__ lists, one after the other into the slots of sections: every parts-th array, from `first` on. */
static inline void dem__arrange_part(dem_world *w, const dem__section *section, int sections, const dem__array *list, int arrays, int first,
                                     int parts) {
    char *scratch = (char *)w->live_handed__ + (size_t)first * (size_t)w->live_capacity__ * sizeof(double);
    ptrdiff_t n = 0;
    for (int q = 0; q < sections; q++) n += section[q].live;
    for (int a = first; a < arrays; a += parts) {
        const size_t size = list[a].size;
        const char *from = scratch;
        char *base;
        memcpy(&base, list[a].address, sizeof base);
        dem__pick(scratch, base, size, w->slots__, n);
        for (int q = 0; q < sections; q++) {
            const size_t bytes = (size_t)section[q].live * size;
            memcpy(base + (size_t)section[q].first * size, from, bytes);
            from += bytes;
        }
    }
}
static inline void dem__arrange(dem_world *w, ptrdiff_t n, const dem__section *section, int sections, const dem__array *list, int arrays) {
    const int parts = dem__parts_of(w, n, (int)(sizeof(dem__handed) / sizeof(double))); /* an array to work in each */
    int q;
    if (parts == 1) {
        dem__arrange_part(w, section, sections, list, arrays, 0, 1);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
    for (q = 0; q < parts; q++) dem__arrange_part(w, section, sections, list, arrays, q, parts);
}

DEM_INLINE void dem__divide(dem_world *w, ptrdiff_t i) { w->share__[i] = w->touching[i] > 1 ? 1.0 / (double)w->touching[i] : 1.0; }

DEM_INLINE void dem__activate(dem_world *w, ptrdiff_t i) {
    w->touching[i]++;
    dem__divide(w, i);
    if (w->is_active__[i]) return;
    w->is_active__[i] = 1;
    w->active__[w->active_count__++] = (int32_t)i;
}

static inline void dem__fold_constants(dem_world *w, ptrdiff_t c, const dem_law *law, int features) {
    dem_birth b;
    dem__kind kind;
    const ptrdiff_t i = w->live_i__[c], j = w->live_j__[c];
    const double inertia = dem__inertia(w, i);
    int same = w->kinds__ > DEM_KINDS_MAX ? w->kinds__ : 0; /* more than fit: nobody looks */
    memset(&b, 0, sizeof b);
    memset(&kind, 0, sizeof kind);
    b.def = &w->def;
    b.features = features;
    b.material_i = w->material[i];
    b.radius_i = w->particle[i].radius;
    if (j >= 0) {
        double other = dem__inertia(w, j);
        b.material_j = w->material[j];
        b.radius_j = w->particle[j].radius;
        b.mass = w->particle[i].mass * w->particle[j].mass / (w->particle[i].mass + w->particle[j].mass);
        b.inertia = inertia * other / (inertia + other);
    } else {
        dem__touch touch;
        dem__touch_element(&w->wall[-1 - j], w->particle[i].x, w->particle[i].radius, w->live_element__[c], &touch);
        b.material_j = w->wall[-1 - j].material;
        b.curvature = w->wall[-1 - j].kind == DEM_CONE ? w->live_place__[0][c] : touch.curvature;
        b.mass = w->particle[i].mass;
        b.inertia = inertia;
    }
    b.pair = b.material_i < b.material_j ? &w->def.pair[b.material_i][b.material_j] : &w->def.pair[b.material_j][b.material_i];
    b.user = w->user;
    b.damping_ratio = w->damping_ratio__[b.material_i][b.material_j];
    const double stiffness = law->prepare(&b, kind.constant);
    kind.mass = b.mass;
    kind.sum = b.radius_i + b.radius_j;
    kind.part = b.radius_i / kind.sum;
    const double k = stiffness * w->dt__ * w->dt__ / b.mass;
    kind.predict = dem__prediction(k, 2.0 * b.damping_ratio * sqrt(k));
    while (same < w->kinds__ && memcmp(&w->kind__[same], &kind, sizeof kind) != 0) same++;
    if (same < DEM_KINDS_MAX) {
        w->live_kind__[c] = same;
        w->kind__[same] = kind;
        w->kinds__ += same == w->kinds__;
        return;
    }
    w->kinds__ = DEM_KINDS_MAX + 1; /* from now on each has its own: to look for a kind would cost more than it saves */
    w->live_kind__[c] = -1;
    for (int a = 0; a < law->constants; a++) w->live_constant__[a][c] = kind.constant[a];
    w->live_mass__[c] = kind.mass;
    w->live_predict__[c] = kind.predict;
    w->live_sum__[c] = kind.sum;
    w->live_part__[c] = kind.part;
}

DEM_INLINE int dem__ascends(const int32_t *list, ptrdiff_t n) {
    for (ptrdiff_t k = 1; k < n; k++) {
        if (list[k] < list[k - 1]) return 0;
    }
    return 1;
}

/* The contacts born since the last call, which slots__ lists by partners, from the end of the last section into sections of their own:
   lists their slots instead. */
static inline void dem__assign(dem_world *w, const dem__array *list, int arrays) {
    dem__section born[DEM__SECTIONS];
    const int last = w->sections__ - 1;
    ptrdiff_t n = 0;
    w->section__[last].live -= w->born__;
    for (int q = 0; q <= last; q++) {
        dem__section *in = &w->section__[q];
        born[q].first = in->first + in->live;
        born[q].live = 0;
    }
    for (ptrdiff_t k = 0, q = 0; k < w->born__; k++) {
        while (w->live_i__[w->slots__[k]] < w->section__[q].from) q++;
        if (q < last && w->section__[q].live + born[q].live == w->section__[q].room) q = last; /* and so all after it */
        born[q].live++;
    }
    if (last > 0 || !dem__ascends(w->slots__, w->born__)) dem__arrange(w, w->born__, born, w->sections__, list, arrays);
    for (int q = 0; q <= last; q++) {
        w->section__[q].live += born[q].live;
        for (ptrdiff_t c = born[q].first; c < born[q].first + born[q].live; c++) {
            w->slots__[n++] = (int32_t)c;
        }
    }
}

/* Makes the contacts born since the last call ready, and puts them into the order. */
static inline void dem__admit_born(dem_world *w, double gap) {
    const ptrdiff_t born = w->born__, old = dem__next_slot(w) - born;
    dem__array list[8] = {{&w->live_i__, sizeof(int32_t)},
                          {&w->live_j__, sizeof(int32_t)},
                          {&w->live_element__, sizeof(int32_t)},
                          {&w->live_near__, sizeof(int32_t)}};
    int arrays = 4;
    for (int a = 0; w->places__ && a < 4; a++, arrays++) list[arrays].address = &w->live_place__[a], list[arrays].size = sizeof(double);
    if (!born) return;
    for (ptrdiff_t k = 0; k < born; k++) w->slots__[k] = (int32_t)(old + k);
    dem__sort(w, w->slots__, born);
    dem__assign(w, list, arrays);
    for (ptrdiff_t k = 0; k < born; k++) {
        const ptrdiff_t c = w->slots__[k], i = w->live_i__[c], j = w->live_j__[c];
        dem__activate(w, i);
        if (j >= 0) dem__activate(w, j);
        else {
            w->live_wall_next__[c] = w->wall_head__[i];
            w->wall_head__[i] = (int32_t)c;
        }
        for (int a = 0; a < w->states__; a++) w->live_state__[a][c] = 0.0;
        w->live_gap__[c] = gap;
        w->live_force__[c] = 0.0;
        w->live_event__[c] = w->live_ended__[c] = 0;
        if (w->ledger_on__) {
            w->live_elastic__[c] = 0.0;
            for (int a = 0; a < 3; a++) w->live_power__[a][c] = 0.0;
        }
    }
    w->born__ = 0;
}

/* Tells the law of the contacts in the slots that slots__ lists. */
static inline void dem__tell_born(dem_world *w, const dem_law *law, ptrdiff_t born) {
    if (!law->born || born == 0) return;
    for (ptrdiff_t k = 0; k < born; k++) w->slots__[k] = dem__number_of(w, w->slots__[k]);
    law->born(w, w->slots__, born, w->user);
}

static inline void dem__unlink_wall_contact(dem_world *w, ptrdiff_t i, int32_t slot, int32_t replacement) {
    int32_t *link = &w->wall_head__[i];
    while (*link >= 0 && *link != slot) link = &w->live_wall_next__[*link];
    if (*link == slot) *link = replacement >= 0 ? replacement : w->live_wall_next__[slot];
}

/* Ahead of a look at a particle's course. */
DEM_INLINE void dem__fetch_flight(const dem_world *w, ptrdiff_t i) {
    dem__fetch_particle(w, i);
    DEM__PREFETCH(&w->course__[i]);
}

/* Ahead of a contact's end. */
DEM_INLINE void dem__fetch_end(const dem_world *w, ptrdiff_t c) {
    const int32_t p = w->live_near__[c];
    dem__fetch_flight(w, w->live_i__[c]);
    if (p < 0) return;
    dem__fetch_flight(w, w->live_j__[c]);
    DEM__PREFETCH(&w->near__[p]);
    DEM__PREFETCH(&w->pair_timers__.due[p]);
}

/* One contact ends. */
static inline void dem__end(dem_world *w, dem__waits *waits, int32_t c, int64_t step) {
    const ptrdiff_t i = w->live_i__[c], j = w->live_j__[c];
    const int32_t near_pair = w->live_near__[c];
    if (w->law__ && w->law__->ended) w->law__->ended(w, dem__number_of(w, c), w->user);
    w->touching[i]--;
    dem__divide(w, i);
    dem__unsettle(w, i);
    if (w->ledger_on__) w->ledger__.sliding_loss += w->live_elastic__[c];
    if (j >= 0) {
        w->touching[j]--;
        dem__divide(w, j);
        dem__unsettle(w, j);
        if (near_pair < 0 || w->stale__) return;
        if (!(w->alive[i] > 0 && w->alive[j] > 0)) return;
        w->pair_timers__.due[near_pair] = DEM__NEVER;
        if (w->def.skip & DEM_SKIP_PAIRS) dem__wait_from(w, waits, near_pair, step, dem__pair_apart(w, i, j, step));
        return;
    }
    dem__unlink_wall_contact(w, i, c, -1);
    /* a screen's timer went on for its other bars, but did not wait for this one */
    if (!w->stale__ && w->alive[i] > 0 && (w->def.skip & DEM_SKIP_SPACE) && dem__awaits(w, i, -1 - (int)j))
        dem__set_timer(&w->wall_timers__, (int32_t)i * w->walls - 1 - (int32_t)j, step + 1);
}

/* The contact of slot `from` goes into a free one. */
static inline void dem__move_contact(dem_world *w, int32_t from, int32_t to, const dem__array *list, int n) {
    if (w->live_j__[from] < 0) {
        w->live_wall_next__[to] = w->live_wall_next__[from];
        dem__unlink_wall_contact(w, w->live_i__[from], from, to);
    }
    for (int a = 0; a < n; a++) {
        char *base;
        memcpy(&base, list[a].address, sizeof base);
        dem__copy(base + (size_t)to * list[a].size, base + (size_t)from * list[a].size, list[a].size);
    }
}

/* Takes out contacts that ended, of those that the last step marked or of all: slots at the end of their section fill the gaps. */
static inline void dem__bury(dem_world *w, int64_t step, int all) {
    dem__array list[DEM__ARRAYS_MAX];
    const ptrdiff_t dead = dem__list_ended(w, all);
    if (dead == 0) return;
    const int n = dem__held_arrays(w, list);
    ptrdiff_t next = 0;
    dem__waits waits;
    dem__no_waits(&waits);
    for (ptrdiff_t k = -DEM__AHEAD; k < dead; k++) {
        if (k + DEM__AHEAD < dead) dem__fetch_end(w, w->slots__[k + DEM__AHEAD]);
        if (k >= 0) dem__end(w, &waits, w->slots__[k], step);
    }
    dem__set_waits(w, &waits, step);
    w->live_count__ -= dead;
    for (int q = 0; q < w->sections__; q++) {
        dem__section *in = &w->section__[q];
        const ptrdiff_t first = next;
        ptrdiff_t last = in->first + in->live;
        while (next < dead && w->slots__[next] < last) next++;
        in->live -= next - first;
        for (ptrdiff_t k = first; k < next && w->slots__[k] < in->first + in->live; k++) {
            while (w->live_ended__[last - 1]) last--;
            dem__move_contact(w, (int32_t)--last, w->slots__[k], list, n);
        }
    }
}

/* Of active particles first .. end-1, where memory is not asked ahead any more: the first, unless they are few and so lie far apart. */
DEM_INLINE ptrdiff_t dem__fetch_until(const dem_world *w, ptrdiff_t first, ptrdiff_t end) {
    return 4 * w->active_count__ < w->count ? end - DEM__AHEAD : first;
}

/* Active particles first .. end-1 to the time of the step that is being computed; their velocities to the middle of it. */
DEM_INLINE void dem__advance_all(dem_world *w, double h, ptrdiff_t first, ptrdiff_t end) {
    const int64_t step = w->step + (h > 0.0);
    const ptrdiff_t apart = dem__fetch_until(w, first, end);
    for (ptrdiff_t k = first; k < end; k++) {
        const ptrdiff_t i = w->active__[k];
        if (k < apart) dem__fetch_particle(w, w->active__[k + DEM__AHEAD]);
        dem_particle *p = &w->particle[i];
        const double t = (double)(step - p->origin) * w->dt__, middle = t - 0.5 * h;
        p->x = dem__at(w, i, t), p->v = dem__velocity_at(w, i, middle), p->spin = dem__spin_at(w, i, middle);
        if (w->has_periodic__) dem__wrap(w, i);
    }
}
DEM__TWICE(dem__advance_part, (dem_world * w, double h, ptrdiff_t first, ptrdiff_t end), (w, h, first, end),
           dem__advance_all(w, h, first, end))
static inline void dem__advance(dem_world *w, double h) {
    const ptrdiff_t n = w->active_count__;
    const int books = w->ledger_on__ && w->has_periodic__; /* those who leave the box are one sum */
    const int parts = books ? 1 : dem__parts(w, n / 4);    /* to move or kick a particle is little work */
    int q;
    if (parts == 1) {
        dem__advance_part(w, h, 0, n);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
    for (q = 0; q < parts; q++) dem__advance_part(w, h, dem__part(n, q, parts), dem__part(n, q + 1, parts));
}

static inline void dem__gather_losses(dem_world *w) {
    dem_energy_ledger *l = &w->ledger__;
    DEM__EACH(w, k) {
        l->normal_loss += w->live_loss__[0][k];
        l->sliding_loss += w->live_loss__[1][k];
        l->rolling_loss += w->live_loss__[2][k];
        l->wall_work += w->live_loss__[3][k];
    }
    for (ptrdiff_t k = 0; w->loads_on__ && k < w->active_count__; k++) {
        const ptrdiff_t i = w->active__[k];
        l->external_work += w->dt__ * dem__dot(dem__first(w->external__[i]), w->particle[i].v);
        l->external_work += w->dt__ * dem__dot(dem__second(w->external__[i]), w->particle[i].spin);
    }
}

/* Of a particle settled at time t on the courses: how far its velocity is from that of its course. */
DEM_INLINE dem_vec dem__stray(const dem_world *w, ptrdiff_t i, double t) {
    const dem__course *c = &w->course__[i];
    return dem__sub(dem__plus(w->particle[i].v, -t, w->def.gravity), dem_vec3(c->ux, c->uy, c->uz));
}

/* The same at the end of the next step: between, it is on the line from one to the other. */
DEM_INLINE dem_vec dem__stray_next(const dem_world *w, ptrdiff_t i, dem_vec d) {
    return dem__plus(d, w->dt__, dem__sub(w->particle[i].a, w->def.gravity));
}

/* Is the velocity of a particle, d from that of its course, within its ball to the end of the next step? */
DEM_INLINE int dem__holds_course(const dem_world *w, ptrdiff_t i, dem_vec d) {
    const dem_vec e = dem__stray_next(w, i, d);
    const double ball = w->course__[i].ball * w->course__[i].ball;
    return dem__dot(d, d) < ball && dem__dot(e, e) < ball && w->shifted__[i] < w->blur__; /* false for NaN */
}

/* Is the velocity sure to stay within its ball, to the end of the next step? */
DEM_INLINE int dem__stays(dem_particle *p, double dt, dem_vec pull) {
    const double way = dem__way(dt, pull);
    p->room__ -= way;
    return p->room__ > 0.5 * way; /* false for NaN */
}

/* New accelerations of active particles first .. end-1, and their velocities from the middle of the step to its end. Sums are zero
   afterwards, ready for the next. Those that may leave their balls are listed in remap__ from `first` on. */
DEM_INLINE void dem__kick_all(dem_world *w, double h, ptrdiff_t first, ptrdiff_t end, double *check, ptrdiff_t *strays) {
    const int64_t step = w->step + (h > 0.0);
    const double half = 0.5 * h;
    const int loads = w->loads_on__ || w->links_on__;
    const ptrdiff_t apart = dem__fetch_until(w, first, end);
    double all = 0.0;
    ptrdiff_t n = 0;
    for (ptrdiff_t k = first; k < end; k++) {
        const ptrdiff_t i = w->active__[k];
        if (k < apart) dem__fetch_partner(w, w->active__[k + DEM__AHEAD]);
        dem__sum *sum = &w->sum__[i];
        dem_particle *p = &w->particle[i];
        dem_vec force = dem__first(sum->load), torque = dem__second(sum->load);
        if (loads) {
            force = dem__add(force, dem__first(w->load__[i]));
            torque = dem__add(torque, dem__second(w->load__[i]));
        }
        const dem_vec pull = dem__scale(sum->per_mass, force);
        p->a = dem__add(w->def.gravity, pull);
        const dem_vec turn = dem__scale(sum->per_inertia, torque);
        w->spin_rate[i] = turn;
        p->v = dem__plus(p->v, half, p->a);
        p->spin = dem__plus(p->spin, half, turn);
        p->origin = step;
        for (int a = 0; a < 6; a++) sum->load[a] = 0.0;
        all += pull.x + pull.y + pull.z + turn.x + turn.y + turn.z;
        w->remap__[first + n] = (int32_t)i; /* without a branch, which nobody could predict */
        n += !dem__stays(p, w->dt__, pull);
    }
    *check = 0.0 * all;
    *strays = n;
}
DEM__TWICE(dem__kick_part, (dem_world * w, double h, ptrdiff_t first, ptrdiff_t end, double *check, ptrdiff_t *strays),
           (w, h, first, end, check, strays), dem__kick_all(w, h, first, end, check, strays))

/* Of n particles those that leave their balls; how many. The others get room anew. */
static inline ptrdiff_t dem__find_strays(dem_world *w, double h, int32_t *doubtful, ptrdiff_t n) {
    const double t = dem__since_listed(w, w->step + (h > 0.0));
    ptrdiff_t strays = 0;
    for (ptrdiff_t k = -DEM__AHEAD; k < n; k++) {
        if (k + DEM__AHEAD < n) dem__fetch_flight(w, doubtful[k + DEM__AHEAD]);
        if (k < 0) continue;
        const int32_t i = doubtful[k];
        const dem_vec stray = dem__stray(w, i, t);
        if (dem__holds_course(w, i, stray)) dem__leave_room(w, i, dem__length(stray));
        else doubtful[strays++] = i;
    }
    return strays;
}
static inline void dem__kick_share(dem_world *w, double h, ptrdiff_t first, ptrdiff_t end, double *check, ptrdiff_t *strays) {
    dem__kick_part(w, h, first, end, check, strays);
    *strays = dem__find_strays(w, h, w->remap__ + first, *strays);
}
static inline int dem__kick(dem_world *w, double h) {
    const ptrdiff_t n = w->active_count__;
    const int parts = dem__parts(w, n / 4); /* to move or kick a particle is little work */
    double check[DEM__PARTS_MAX], all = 0.0;
    ptrdiff_t strays[DEM__PARTS_MAX];
    int q;
    if (parts == 1) dem__kick_share(w, h, 0, n, &check[0], &strays[0]);
    else {
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
        for (q = 0; q < parts; q++) dem__kick_share(w, h, dem__part(n, q, parts), dem__part(n, q + 1, parts), &check[q], &strays[q]);
    }
    for (q = 0; q < parts; q++) {
        const int32_t *stray = w->remap__ + dem__part(n, q, parts);
        for (ptrdiff_t k = 0; k < strays[q]; k++) dem__unsettle(w, stray[k]);
        all += check[q];
    }
    return all == 0.0;
}

/* A contact that has just begun turns the normal velocities of its bodies to and fro about that of their centre of mass: what leads there,
   for their courses. */
DEM_INLINE void dem__expect_impact(dem_world *w, ptrdiff_t i, ptrdiff_t j, dem_vec n, double closing) {
    if (!(closing > 0.0)) return; /* it has ended */
    const double part = j < 0 ? 1.0 : w->particle[j].mass / (w->particle[i].mass + w->particle[j].mass);
    w->impact__[i] = dem__scale(part * closing, n);
    if (j >= 0) w->impact__[j] = dem__scale((part - 1.0) * closing, n);
}

/* Impulse and shift of the contact in slot c, which began or ended within the step. */
static inline void dem__settle_event(dem_world *w, int32_t c, int turns) {
    const dem__handed *h = &w->live_handed__[c];
    const int32_t i = w->live_i__[c], j = w->live_j__[c];
    const dem_vec n = dem_vec3(h->n[0], h->n[1], h->n[2]), impulse = dem__first(h->impulse);
    for (int side = 0; side < (j >= 0 ? 2 : 1); side++) {
        const int32_t a = side ? j : i;
        dem__unsettle(w, a);
        dem_particle *p = &w->particle[a];
        const double m = (side ? -1.0 : 1.0) / p->mass;
        p->v = dem__plus(p->v, m, impulse);
        p->x = dem__plus(p->x, m * h->shift, n);
        w->shifted__[a] += fabs(m * h->shift);
        if (!turns) continue;
        const dem_vec torque = dem__first(h->impulse + (side ? 6 : 3));
        p->spin = dem__plus(p->spin, 1.0 / dem__inertia(w, a), torque);
    }
    if (j < 0) {
        const dem_vec place = w->particle[i].x, t = turns ? dem__second(h->impulse) : dem_vec3(0.0, 0.0, 0.0);
        const dem_vec v = dem__sub(w->particle[i].v, dem__surface_velocity(&w->wall[-1 - j], place, n));
        dem__strike_wall(&w->wall[-1 - j], place, dem__scale(-1.0, impulse), dem__scale(-1.0, t));
        dem__expect_impact(w, i, j, n, -dem__dot(v, n));
        return;
    }
    /* a pair that is moved apart turns more slowly, as its angular momentum stays */
    dem_particle *a = &w->particle[i], *b = &w->particle[j];
    const dem_vec d = dem__apart(w, dem__sub(a->x, b->x)), v = dem__sub(a->v, b->v);
    const dem_vec slower = dem__scale(-h->shift / dem__length(d), dem__sub(v, dem__scale(dem__dot(v, n), n)));
    a->v = dem__plus(a->v, 1.0 / a->mass, slower);
    b->v = dem__plus(b->v, -1.0 / b->mass, slower);
    dem__expect_impact(w, i, j, n, -dem__dot(v, n));
}
static inline void dem__settle_events(dem_world *w, int turns) {
    for (const dem__section *in = w->section__; in < w->section__ + w->sections__; in++) {
        for (ptrdiff_t k = 0; k < in->marked; k++) {
            const int32_t c = w->slots__[in->first + k];
            if (w->live_event__[c]) dem__settle_event(w, c, turns);
        }
    }
}

/* What became of a thread's share of the unsettled: how many have new courses, how many of those are to look at a wall sooner, and does
   any begin a flight. */
typedef struct dem__watched {
    ptrdiff_t restarted, hurried;
    int flown;
    dem__news news;
} dem__watched;

/* Ahead of a watch. */
DEM_INLINE void dem__fetch_unsettled(const dem_world *w, ptrdiff_t i) {
    dem__fetch_flight(w, i);
    DEM__PREFETCH(&w->listed_at__[i]);
    DEM__PREFETCH(&w->alive[i]);
    DEM__PREFETCH(&w->touching[i]);
    DEM__PREFETCH(&w->shifted__[i]);
    DEM__PREFETCH(&w->wall_speed__[i]);
    DEM__PREFETCH(&w->wall_timers__.due[i * w->walls]);
    DEM__PREFETCH(&w->wall_sure__[i * w->walls]);
}

/* Unsettled particles first .. end-1: whose velocity left its ball, or whose flight begins, gets a new course and is listed in remap__ from
   `first` on; unsettled__ lists from there those that are to look at a wall sooner. */
static inline void dem__watch_part(dem_world *w, ptrdiff_t first, ptrdiff_t end, dem__watched *q) {
    const dem__list_frame frame = dem__frame_at(w, w->step);
    const double t = dem__since_listed(w, w->step);
    q->restarted = q->hurried = q->flown = 0;
    q->news = dem__no_news(w);
    for (ptrdiff_t k = first - DEM__AHEAD; k < end; k++) {
        if (k + DEM__AHEAD < end) dem__fetch_unsettled(w, w->unsettled__[k + DEM__AHEAD]);
        if (k < first) continue;
        const int32_t i = w->unsettled__[k];
        if (w->alive[i] && !w->stale__) {
            const dem_particle *p = &w->particle[i];
            const dem_vec stray = dem__stray(w, i, t);
            if (w->touching[i] == 0 || !dem__holds_course(w, i, stray)) {
                const double shifted = w->shifted__[i];
                dem__set_course(w, i, w->step, p->x, p->v);
                w->remap__[first + q->restarted++] = i;
                if (dem__heed_course(w, i, w->step, &frame, p->x, p->v, shifted, &q->news)) w->unsettled__[first + q->hurried++] = i;
            } else dem__leave_room(w, i, dem__length(stray));
        }
        w->impact__[i] = dem_vec3(0.0, 0.0, 0.0);
        w->is_active__[i] = w->alive[i] && (w->touching[i] > 0 || (w->loads_on__ && dem__is_loaded(w, i)));
        q->flown |= !w->is_active__[i];
    }
}

/* Courses and timers of the unsettled; those whose flight begins leave the list of active particles. */
static inline void dem__watch(dem_world *w) {
    const ptrdiff_t n = w->unsettled_count__, active = w->active_count__;
    const int parts = dem__parts(w, 4 * n);
    dem__watched watched[DEM__PARTS_MAX];
    ptrdiff_t restarted = 0, kept = 0;
    int q, flown = 0;
    if (parts == 1) dem__watch_part(w, 0, n, &watched[0]);
    else {
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
        for (q = 0; q < parts; q++) dem__watch_part(w, dem__part(n, q, parts), dem__part(n, q + 1, parts), &watched[q]);
    }
    for (q = 0; q < parts; q++) {
        const ptrdiff_t first = dem__part(n, q, parts);
        for (ptrdiff_t k = 0; k < watched[q].hurried; k++) dem__hurry_to_walls(w, w->unsettled__[first + k], w->step);
        for (ptrdiff_t k = 0; k < watched[q].restarted; k++) w->remap__[restarted++] = w->remap__[first + k];
        dem__take_news(w, &watched[q].news);
        flown |= watched[q].flown;
    }
    dem__restart(w, w->remap__, restarted, w->step);
    w->unsettled_count__ = 0;
    if (!flown) return;
    for (ptrdiff_t k = 0; k < active; k++) {
        const int32_t i = w->active__[k];
        w->active__[kept] = i;
        kept += w->is_active__[i] != 0;
    }
    w->active_count__ = kept;
    if (2 * kept > w->count && w->step % 16 == 0) dem__list_active(w);
}

static inline int dem__fail(dem_world *w, dem_status status) {
    w->status = status;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_particle *p = &w->particle[i];
        const dem_vec sum = dem__add(dem__add(p->v, p->a), dem__add(p->spin, w->spin_rate[i]));
        const double v = sum.x + sum.y + sum.z;
        if (!(fabs(v) <= DBL_MAX)) {
            w->failed_id = w->id[i];
            break;
        }
    }
    return 0;
}

/* Looks at the pairs that are due, in sheaves first .. end-1. */
static inline void dem__look_in(dem_world *w, dem__waits *waits, ptrdiff_t first, ptrdiff_t end, int64_t step) {
    int32_t *due = w->pair_timers__.list + first * DEM__SHEAF;
    ptrdiff_t n;
    dem__list_due(&w->pair_timers__, first, end, step, DEM__NEVER, &n);
    dem__no_waits(waits);
    waits->found = due; /* what is found overwrites what has been looked at */
    for (ptrdiff_t k = -2 * DEM__AHEAD; k < n; k++) {
        const ptrdiff_t flight = k + DEM__AHEAD, pair = flight + DEM__AHEAD;
        if (pair < n) DEM__PREFETCH(&w->near__[due[pair]]);
        if (flight >= 0 && flight < n) {
            dem__fetch_flight(w, w->near__[due[flight]].i);
            dem__fetch_flight(w, w->near__[due[flight]].j);
        }
        if (k >= 0) dem__look_at_pair(w, waits, due[k], step);
    }
    dem__set_waits(w, waits, step);
}

/* Threads take sheaves of their own, if about as many pairs are due as in the step before. */
static inline void dem__look_at_due(dem_world *w, int64_t step) {
    const ptrdiff_t sheaves = w->pair_timers__.sheaves;
    const int parts = dem__parts_of(w, w->due__, DEM__SECTIONS);
    dem__waits waits[DEM__SECTIONS];
    int q;
    if (parts == 1) dem__look_in(w, &waits[0], 0, sheaves, step);
    else {
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
        for (q = 0; q < parts; q++) dem__look_in(w, &waits[q], dem__part(sheaves, q, parts), dem__part(sheaves, q + 1, parts), step);
    }
    w->due__ = 0;
    for (q = 0; q < parts; q++) {
        w->due__ += (ptrdiff_t)waits[q].looks;
        dem__bear_found(w, &waits[q]);
    }
}

/* Looks at all pairs that do not touch. */
static inline void dem__look_at_pairs(dem_world *w, int64_t step) {
    dem__waits waits;
    dem__no_waits(&waits);
    waits.found = w->pair_timers__.list;
    for (int32_t p = 0; p < (int32_t)w->near_count__; p++) {
        if (w->pair_timers__.due[p] != DEM__STOPPED) dem__look_at_pair(w, &waits, p, step);
    }
    dem__bear_found(w, &waits);
}

/* Looks at everything whose time has come, at the given step. */
static inline void dem__look(dem_world *w, int64_t step) {
    if (w->meshes__) dem__follow(w, step);
    if (!(w->def.skip & DEM_SKIP_PAIRS)) dem__look_at_pairs(w, step);
    if (!(w->def.skip & DEM_SKIP_SPACE)) {
        for (int32_t e = 0; e < (int32_t)(w->count * w->walls); e++) {
            if (dem__awaits(w, e / w->walls, (int)(e % w->walls))) dem__look_at_wall(w, e, step);
        }
    }
    dem__look_at_due(w, step);
    ptrdiff_t n;
    dem__list_due(&w->wall_timers__, 0, w->wall_timers__.sheaves, step, DEM__STOPPED, &n);
    for (ptrdiff_t k = 0; k < n; k++) dem__look_at_wall(w, w->wall_timers__.list[k], step);
}

/* Takes back what was found in a step that cannot be finished. */
static DEM__APART int dem__undo_look(dem_world *w) {
    for (; w->born__ > 0; w->born__--) {
        const int32_t p = w->live_near__[dem__next_slot(w) - 1];
        w->section__[w->sections__ - 1].live--;
        w->live_count__--;
        if (p >= 0) w->pair_timers__.due[p] = DEM__NEVER;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i] < 0) w->alive[i] = 1, w->passed_count--;
    }
    w->leaving__ = 0;
    for (int k = 0; k < w->walls; k++) dem__move_wall(&w->wall[k], w->time);
    return 0;
}

/* Blocks of links to threads. */
static inline void dem__share_blocks(dem_world *w, dem_kernel_fn kernel, ptrdiff_t count) {
    const ptrdiff_t blocks = (count + DEM_BLOCK - 1) / DEM_BLOCK;
    const int parts = dem__parts(w, count);
    int q;
    if (parts == 1) {
        kernel(w, 0, count);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
    for (q = 0; q < parts; q++) {
        const ptrdiff_t first = DEM_BLOCK * dem__part(blocks, q, parts), end = DEM_BLOCK * dem__part(blocks, q + 1, parts);
        kernel(w, first, end < count ? end : count);
    }
}

/* Adds what the threads that evaluated the contacts could not to the sums of particles low .. high-1. */
static inline void dem__add_later(dem_world *w, int32_t low, int32_t high, int turns) {
    for (const dem__section *in = w->section__; in < w->section__ + w->sections__; in++) {
        dem__deferral *later = w->deferral__ + in->first;
        if (in->deferred == 0 || in->low >= high || in->high < low) continue;
        for (ptrdiff_t k = 0; k < in->deferred; k++, later++) {
            const int32_t from = low > in->own ? low : in->own; /* the rest has been added */
            const int to_i = later->i >= from && later->i < high, to_j = later->j >= from && later->j < high;
            double *out[9];
            for (int a = 0; a < 9; a++) out[a] = &later->out[a];
            dem__add_forces(w, 0, later->i, later->j, out, 0, turns, to_i, to_j);
        }
    }
}

/* A thread adds to particles of the share before the one that it has evaluated (the first of those to the last): nearly all of what waits
   for them it has left itself, and has in its cache. */
static inline void dem__add_deferred(dem_world *w, int turns) {
    const int sections = w->sections__;
    ptrdiff_t n = 0;
    int q;
    for (q = 0; q < sections; q++) n += w->section__[q].deferred;
    const int parts = dem__parts_of(w, n, sections);
    if (parts == 1) {
        dem__add_later(w, 0, INT32_MAX, turns);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
    for (q = 0; q < parts; q++) {
        const int share = (2 * parts - 2 - q) % parts;
        const ptrdiff_t first = dem__part(sections, share, parts), end = dem__part(sections, share + 1, parts);
        dem__add_later(w, w->section__[end - 1].from, first > 0 ? w->section__[first - 1].from : INT32_MAX, turns);
    }
}

/* A thread's share of the sections, the last share the first thread's: it takes them from `next` on, others help it from the end. */
typedef struct dem__stint {
    int first, next, end;
} dem__stint;

/* The next section that a thread is to evaluate: of its own share, else the last of the largest that has more than one left, as that one's
   owner has it in its cache; -1: there is none. A thread adds to sums of particles whose contacts it all has, or has first: those
   before `own`. */
static inline int dem__claim(dem_world *w, dem__stint *stint, int parts, int part) {
    int section = -1;
#ifdef _OPENMP
#pragma omp critical(dem_claim)
#endif
    {
        dem__stint *of = &stint[part];
        const int helps = of->next == of->end;
        for (int q = 0; q < parts && helps; q++) of = stint[q].end - stint[q].next > of->end - of->next ? &stint[q] : of;
        if (of->next + helps < of->end) {
            section = helps ? --of->end : of->next++;
            const int first = helps ? section : of->first;
            w->section__[section].own = first > 0 ? w->section__[first - 1].from : INT32_MAX;
        }
    }
    return section;
}
static inline void dem__evaluate_stint(dem_world *w, dem_kernel_fn kernel, dem__stint *stint, int parts, int part) {
    for (int section = dem__claim(w, stint, parts, part); section >= 0; section = dem__claim(w, stint, parts, part))
        kernel(w, section, section + 1);
}

/* Forces of all contacts and their sums; what each contact did is kept if somebody may ask for it. */
static inline void dem__evaluate(dem_world *w, dem_kernel_fn kernel, double h, int turns, int keep) {
    const int parts = w->deferral__ ? dem__parts_of(w, w->live_count__, w->sections__) : 1;
    dem__stint stint[DEM__SECTIONS];
    int q;
    w->kernel_dt__ = h;
    w->keeps_out__ = keep;
    for (q = 0; q < w->sections__; q++) w->section__[q].own = INT32_MAX;
    if (parts == 1) kernel(w, 0, w->sections__);
    else {
        for (q = 0; q < parts; q++) {
            stint[q].first = stint[q].next = (int)dem__part(w->sections__, parts - 1 - q, parts);
            stint[q].end = (int)dem__part(w->sections__, parts - q, parts);
        }
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
        for (q = 0; q < parts; q++) dem__evaluate_stint(w, kernel, stint, parts, q);
        dem__add_deferred(w, turns);
    }
    for (int k = 0; k < w->walls; k++) {
        dem_wall *wall = &w->wall[k];
        wall->force = wall->torque = dem_vec3(0.0, 0.0, 0.0);
        for (q = 0; q < w->sections__; q++) {
            wall->force = dem__add(wall->force, w->push__[q][k].force);
            wall->torque = dem__add(wall->torque, w->push__[q][k].torque);
        }
        wall->impulse = dem__plus(wall->impulse, h, wall->force);
    }
}

/* All contacts into the order of their particles i, the last first, else as they were: neighbours in space are then read one after the
   other. Many in sections of equal size, with room to grow. */
static inline int dem__tidy(dem_world *w) {
    const ptrdiff_t n = w->live_count__;
    const int sections = n < DEM__SECTIONS * 512 ? 1 : DEM__SECTIONS;
    dem__section section[DEM__SECTIONS];
    dem__array list[DEM__ARRAYS_MAX];
    int32_t *place = w->remap__, sum = 0, before = INT32_MAX;
    ptrdiff_t end = 0, cut = 0;
    int in_order = sections == w->sections__;
    DEM__EACH(w, c) {
        in_order &= before >= w->live_i__[c];
        before = w->live_i__[c];
    }
    if (!in_order) {
        for (ptrdiff_t i = 0; i < w->count; i++) place[i] = 0;
        DEM__EACH(w, c) { place[w->live_i__[c]]++; }
        for (ptrdiff_t i = w->count - 1; i >= 0; i--) {
            const int32_t of = place[i];
            place[i] = sum;
            sum += of;
        }
        DEM__EACH(w, c) { w->slots__[place[w->live_i__[c]]++] = (int32_t)c; }
        memset(section, 0, sizeof section);
        for (int q = 0; q < sections; q++) {
            const ptrdiff_t first = cut;
            if (dem__part(n, q + 1, sections) > cut) cut = dem__part(n, q + 1, sections);
            while (cut < n && w->live_i__[w->slots__[cut]] == w->live_i__[w->slots__[cut - 1]]) cut++;
            section[q].from = q < sections - 1 ? w->live_i__[w->slots__[cut - 1]] : 0;
            section[q].first = end;
            section[q].live = cut - first;
            section[q].room = sections > 1 ? section[q].live + section[q].live / 4 + DEM_BLOCK : 0;
            end += section[q].room;
        }
        if (!dem__grow_live(w, end + 1)) {
            w->status = DEM_OUT_OF_MEMORY;
            return 0;
        }
        dem__arrange(w, n, section, sections, list, dem__held_arrays(w, list));
        w->sections__ = sections;
        memcpy(w->section__, section, sizeof section);
        dem__list_wall_contacts(w);
    }
    return 1;
}

/* Begins a run: lists, contacts that are already there, their forces and so the accelerations. */
static DEM__APART int dem__prepare_run(dem_world *w, const dem_law *law, dem_kernel_fn kernel, int features) {
    ptrdiff_t born = 0;
    if (w->stale__) {
        DEM__EACH(w, c) { /* contacts with walls that were taken away */
            if (w->live_j__[c] < 0 && !w->wall[-1 - w->live_j__[c]].enabled) w->live_ended__[c] = 1;
        }
        dem__bury(w, w->step, 1);
        if (!dem__rebuild(w)) return 0;
    }
    for (int k = 0; k < w->walls; k++) dem__move_wall(&w->wall[k], w->time);
    for (int a = 0; a < w->def.materials; a++) {
        for (int b = 0; b < w->def.materials; b++) {
            const dem_pair_def *pair = dem_pair(&w->def, a, b);
            w->damping_ratio__[a][b] = dem_damping_ratio(pair->restitution, pair->mode);
        }
    }
    if (w->fresh__) {
        int skip = w->def.skip;
        w->def.skip = 0; /* everything, once; the timers stay */
        dem__look_at_pairs(w, w->step);
        for (ptrdiff_t i = 0; i < w->count; i++) {
            for (int k = 0; k < w->walls; k++) {
                if (w->wall[k].kind != DEM_EXIT && dem__awaits(w, i, k)) dem__look_at_wall(w, (int32_t)i * w->walls + k, w->step);
            }
        }
        w->def.skip = skip;
        if (w->status != DEM_OK) return dem__undo_look(w);
        born = w->born__;
        dem__admit_born(w, 0.0);
        dem__list_active(w);
        for (ptrdiff_t k = 0; k < born; k++) {
            const int32_t c = w->slots__[k], i = w->live_i__[c], j = w->live_j__[c];
            if (j < 0 && w->wall[-1 - j].kind != DEM_SCREEN) dem__stop_timer(&w->wall_timers__, i * w->walls - 1 - j);
        }
    }
    if (w->fresh__ || w->features__ != features || w->law__ != law) {
        w->kinds__ = 0;
        DEM__EACH(w, c) { dem__fold_constants(w, c, law, features); }
    }
    w->features__ = features;
    w->law__ = law;
    if (w->fresh__) {
        dem__tell_born(w, law, born);
        if (!dem__tidy(w)) return 0;
        dem__advance(w, 0.0);
        dem__evaluate(w, kernel, 0.0, (features & DEM_FRICTION) != 0, 1);
        if (!dem__kick(w, 0.0)) return dem__fail(w, DEM_NOT_FINITE);
        dem__kick_walls(w, 0.0);
        dem__bury(w, w->step, 0);
        dem__watch(w);
        if (w->status != DEM_OK) return 0;
    }
    w->fresh__ = 0;
    if ((features & DEM_ENERGY) && !w->ledger_started__) {
        w->ledger_started__ = 1;
        dem_energy_ledger now = dem_energy(w);
        w->ledger__.start = now.kinetic + now.rotational + now.elastic + now.potential;
        w->ledger__.start_potential = now.potential;
    }
    return 1;
}

DEM_INLINE double dem__motion_energy(const dem_world *w, ptrdiff_t i) { return dem__kinetic(w, i) + dem__rotational(w, i); }

/* Links by velocity Verlet with a step of their own: their forces are constant between two evaluations, and at each the velocities
   get what the mean of the old force and the new one would have made. */
static inline void dem__step_links(dem_world *w) {
    const double h = (double)w->link_stride__ * w->dt__;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->link_head__[i] < 0 && !w->link_loaded__[i]) continue;
        dem__settle(w, i);
        dem__wrap(w, i);
        if (w->ledger_on__) w->ledger__.link_work += dem__link_work(w, i) - dem__motion_energy(w, i);
        for (int a = 0; a < 6; a++) w->sum__[i].load[a] = w->load__[i][a], w->load__[i][a] = w->external__[i][a];
    }
    w->kernel_dt__ = h;
    dem__share_blocks(w, w->link_kernel__, w->link_count__);
    if (dem__parts(w, w->link_count__) > 1) dem__add_links(w, 0, w->link_count__);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->link_head__[i] < 0 && !w->link_loaded__[i]) continue;
        const dem__sum *sum = &w->sum__[i];
        dem_particle *p = &w->particle[i];
        const dem_vec force = dem__sub(dem__first(w->load__[i]), dem__first(sum->load));
        const dem_vec torque = dem__sub(dem__second(w->load__[i]), dem__second(sum->load));
        const dem_vec a = dem__scale(sum->per_mass, force), b = dem__scale(sum->per_inertia, torque); /* changes */
        w->link_loaded__[i] = w->link_head__[i] >= 0;
        p->v = dem__plus(p->v, 0.5 * h, a), p->a = dem__add(p->a, a);
        p->spin = dem__plus(p->spin, 0.5 * h, b), w->spin_rate[i] = dem__add(w->spin_rate[i], b);
        if (w->ledger_on__) {
            w->ledger__.link_work += dem__motion_energy(w, i);
            for (int q = 0; q < 3; q++) w->linked__[i][q] = dem_axis(p->x, q), w->linked__[i][3 + q] = dem_axis(p->spin, q);
        }
        for (int q = 0; q < 6; q++) w->sum__[i].load[q] = 0.0;
        if (w->stale__) continue;
        const double strayed = dem__length(dem__stray(w, i, dem__since_listed(w, w->step)));
        if (strayed < w->course__[i].ball - dem__link_drift(w, i)) dem__leave_room(w, i, strayed);
        else {
            const int32_t one = (int32_t)i;
            dem__begin_course(w, i, w->step);
            dem__restart(w, &one, 1, w->step);
        }
    }
    for (int32_t k = 0; k < (int32_t)w->link_count__;) {
        if (w->link_ended__[k]) dem__cut_link(w, k);
        else k++;
    }
}

static inline int dem__step(dem_world *w, const dem_law *law, dem_kernel_fn kernel, int features, int keep) {
    const int turns = (features & DEM_FRICTION) != 0;
    if (w->step % DEM__TIDY == 0 && !dem__tidy(w)) return 0;
    if (w->step >= w->next_check__ && !dem__check_list(w)) return 0;
    if (!dem__move_walls(w, w->step + 1)) w->status = DEM_NOT_FINITE;
    else dem__look(w, w->step + 1);
    if (w->status != DEM_OK) return dem__undo_look(w);
    if (w->born__) {
        const ptrdiff_t born = w->born__;
        dem__admit_born(w, 1.0);
        dem__advance(w, w->dt__);
        for (ptrdiff_t k = 0; k < born; k++) dem__fold_constants(w, w->slots__[k], law, features);
        dem__tell_born(w, law, born);
    } else dem__advance(w, w->dt__);
    dem__evaluate(w, kernel, w->dt__, turns, keep);
    if (features & DEM_ENERGY) dem__gather_losses(w);
    const int finite = dem__kick(w, w->dt__);
    dem__kick_walls(w, w->dt__);
    dem__settle_events(w, turns);
    w->particle_steps += w->count - w->dropped__;
    w->contact_steps += w->live_count__;
    w->step++;
    w->time = w->start_time__ + (double)(w->step - w->start_step__) * w->dt__;
    if (!finite) return dem__fail(w, DEM_NOT_FINITE);
    const int leaving = w->leaving__;
    if (leaving) {
        DEM__EACH(w, c) {
            const ptrdiff_t j = w->live_j__[c];
            if (w->alive[w->live_i__[c]] < 0 || (j >= 0 && w->alive[j] < 0)) w->live_ended__[c] = 1;
        }
        for (ptrdiff_t i = 0; i < w->count; i++) {
            if (w->alive[i] < 0) dem__forget(w, i);
        }
        w->leaving__ = 0;
    }
    dem__bury(w, w->step, leaving);
    if (leaving) dem__let_go(w);
    dem__watch(w);
    if (w->link_stride__ > 0 && w->step % w->link_stride__ == 0) dem__step_links(w);
    return w->status == DEM_OK;
}

/* A kernel says so of no contacts if it is not for this law and these features. */
static inline int dem__fits(dem_world *w, const dem_law *law, dem_kernel_fn kernel, int features) {
    const dem_law *old_law = w->law__;
    const int old_features = w->features__;
    w->law__ = law, w->features__ = features;
    kernel(w, 0, 0);
    const int fits = w->status == DEM_OK;
    w->law__ = old_law, w->features__ = old_features;
    w->status = DEM_OK;
    return fits;
}

DEM_API dem_status dem_run_law(dem_world *world, double duration, const dem_law *law, dem_kernel_fn kernel, int features) {
    dem_world *w = world;
    if (!w || !w->def.allocator.fn || !law || !kernel || !law->force || !law->prepare || !(duration >= 0.0 && duration <= DBL_MAX))
        return DEM_BAD_ARGUMENT;
    if (law->states < 0 || law->states > DEM_STATE_MAX || law->vectors < 0 || 3 * law->vectors > law->history || law->history > law->states)
        return DEM_BAD_ARGUMENT;
    if (law->constants < 0 || law->constants > DEM_CONSTANTS_MAX) return DEM_BAD_ARGUMENT;
    double remaining = (w->target__ + duration - w->time) / w->dt__;
    if (!(remaining < 9e15)) return DEM_BAD_ARGUMENT;
    if (w->status != DEM_OK) return w->status;
    if (!dem__fits(w, law, kernel, features)) return DEM_BAD_ARGUMENT;
    for (int k = 0; k < w->walls; k++) {
        if (w->wall[k].drive == DEM_PRESCRIBED && !w->wall[k].motion) return DEM_NO_MOTION;
    }
    const double narrowest = dem__narrowest(w);
    for (ptrdiff_t i = 0; i < w->count && narrowest < HUGE_VAL; i++) {
        if (w->alive[i] && !(narrowest > 4.4 * w->particle[i].radius)) return DEM_BAD_DEFINITION;
    }
    if (law->states != w->states__ && w->live_count__ > 0) return DEM_LAW_MISMATCH;
    if (w->link_count__ > 0 && !w->link_law__) return DEM_LAW_MISMATCH; /* loaded: dem_set_links comes first */
    const int ledger = w->ledger_on__ || (features & DEM_ENERGY),
              constants = law->constants > w->constants__ ? law->constants : w->constants__;
    const int deferrals = dem__has_deferrals(w) && !w->deferral__;
    if (law->states != w->states__ || constants != w->constants__ || ledger != w->ledger_on__ ||
        deferrals) { /* other arrays: a new block */
        dem__array list[DEM__ARRAYS_MAX];
        const int old_states = w->states__, old_constants = w->constants__, old_ledger = w->ledger_on__;
        const ptrdiff_t old_capacity = w->live_capacity__;
        w->states__ = law->states, w->constants__ = constants, w->ledger_on__ = ledger;
        if (!dem__grow_group(w, list, dem__live_arrays(w, list), &w->live_block__, &w->live_bytes__, &w->live_capacity__,
                             dem__next_slot(w) + 1)) {
            w->states__ = old_states, w->constants__ = old_constants, w->ledger_on__ = old_ledger;
            w->live_capacity__ = old_capacity;
            return DEM_OUT_OF_MEMORY;
        }
        for (int a = w->states__; a < DEM_STATE_MAX; a++) w->live_state__[a] = NULL; /* not in the block */
    }
    if (!dem__prepare_run(w, law, kernel, features)) return w->status;
    w->target__ += duration;
    for (int64_t n = remaining > 0.0 ? (int64_t)floor(remaining + 0.5) : 0; n > 0; n--) {
        if (!dem__step(w, law, kernel, features, n == 1)) return w->status;
    }
    return DEM_OK;
}

/* name, version, states, history, vectors, constants, prepare, force, born, ended */
static const dem_law dem_law_linear = {"linear", 1, 0, 0, 0, DEM_LINEAR_CONSTANTS, dem_prepare_linear, dem_force_linear, NULL, NULL};
static const dem_law dem_law_linear_friction = {"linear, friction",        1,    3,   3, 1, DEM_LINEAR_CONSTANTS, dem_prepare_linear,
                                                dem_force_linear_friction, NULL, NULL};
static const dem_law dem_law_linear_rolling = {"linear, friction, rolling", 1,    3,   3, 1, DEM_LINEAR_CONSTANTS, dem_prepare_linear,
                                               dem_force_linear_rolling,    NULL, NULL};
static const dem_law dem_law_hertz = {"Hertz", 1, 0, 0, 0, DEM_HERTZ_CONSTANTS, dem_prepare_hertz, dem_force_hertz, NULL, NULL};
static const dem_law dem_law_hertz_friction = {"Hertz-Mindlin",          1,    4,   4, 1, DEM_HERTZ_CONSTANTS, dem_prepare_hertz,
                                               dem_force_hertz_friction, NULL, NULL};
static const dem_law dem_law_hertz_rolling = {"Hertz-Mindlin, rolling", 1,    4,   4, 1, DEM_HERTZ_CONSTANTS, dem_prepare_hertz,
                                              dem_force_hertz_rolling,  NULL, NULL};

DEM_KERNEL(dem__kernel_linear, dem_law_linear, DEM_LINEAR)
DEM_KERNEL(dem__kernel_linear_friction, dem_law_linear_friction, DEM_LINEAR | DEM_FRICTION)
DEM_KERNEL(dem__kernel_linear_rolling, dem_law_linear_rolling, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING)
DEM_KERNEL(dem__kernel_linear_energy, dem_law_linear_rolling, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY)
DEM_KERNEL(dem__kernel_hertz, dem_law_hertz, DEM_HERTZ)
DEM_KERNEL(dem__kernel_hertz_friction, dem_law_hertz_friction, DEM_HERTZ | DEM_FRICTION)
DEM_KERNEL(dem__kernel_hertz_rolling, dem_law_hertz_rolling, DEM_HERTZ | DEM_FRICTION | DEM_ROLLING)
DEM_KERNEL(dem__kernel_hertz_energy, dem_law_hertz_rolling, DEM_HERTZ | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY)

DEM_API dem_status dem_run(dem_world *world, double duration, int features) {
    /* the kernels with a ledger compute friction and rolling always; constants of zero take out what the caller did not name */
    switch (features) {
    case DEM_LINEAR: return dem_run_law(world, duration, &dem_law_linear, dem__kernel_linear, features);
    case DEM_LINEAR | DEM_FRICTION: return dem_run_law(world, duration, &dem_law_linear_friction, dem__kernel_linear_friction, features);
    case DEM_LINEAR | DEM_FRICTION | DEM_ROLLING:
        return dem_run_law(world, duration, &dem_law_linear_rolling, dem__kernel_linear_rolling, features);
    case DEM_HERTZ: return dem_run_law(world, duration, &dem_law_hertz, dem__kernel_hertz, features);
    case DEM_HERTZ | DEM_FRICTION: return dem_run_law(world, duration, &dem_law_hertz_friction, dem__kernel_hertz_friction, features);
    case DEM_HERTZ | DEM_FRICTION | DEM_ROLLING:
        return dem_run_law(world, duration, &dem_law_hertz_rolling, dem__kernel_hertz_rolling, features);
    case DEM_LINEAR | DEM_ENERGY:
    case DEM_LINEAR | DEM_FRICTION | DEM_ENERGY:
    case DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY:
        return dem_run_law(world, duration, &dem_law_linear_rolling, dem__kernel_linear_energy, features);
    case DEM_HERTZ | DEM_ENERGY:
    case DEM_HERTZ | DEM_FRICTION | DEM_ENERGY:
    case DEM_HERTZ | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY:
        return dem_run_law(world, duration, &dem_law_hertz_rolling, dem__kernel_hertz_energy, features);
    default: return DEM_BAD_ARGUMENT;
    }
}

/* ----------------------------------------------------------------------------------------------- >>reading */

DEM_API dem_vec dem_position(const dem_world *world, ptrdiff_t i) {
    if (!world || i < 0 || i >= world->count) return dem_vec3((double)NAN, (double)NAN, (double)NAN);
    return dem__in_box(world, dem__at(world, i, dem__now(world, i)));
}

DEM_API dem_vec dem_velocity(const dem_world *world, ptrdiff_t i) {
    if (!world || i < 0 || i >= world->count) return dem_vec3((double)NAN, (double)NAN, (double)NAN);
    return dem__velocity_at(world, i, dem__now(world, i));
}

DEM_API dem_vec dem_momentum(const dem_world *world) {
    dem_vec sum = dem_vec3(0.0, 0.0, 0.0);
    for (ptrdiff_t i = 0; world && i < world->count; i++) {
        if (world->alive[i]) sum = dem__add(sum, dem__scale(world->particle[i].mass, dem_velocity(world, i)));
    }
    return sum;
}

DEM_API dem_energy_ledger dem_energy(const dem_world *world) {
    dem_energy_ledger l;
    memset(&l, 0, sizeof l);
    if (!world) return l;
    l = world->ledger__;
    l.kinetic = l.rotational = l.elastic = l.potential = 0.0;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        if (!world->alive[i]) continue;
        l.kinetic += dem__kinetic(world, i);
        l.rotational += dem__rotational(world, i);
        l.potential += dem__potential(world, i);
        if (world->ledger_on__) l.link_work += dem__link_work(world, i);
    }
    if (world->ledger_on__) {
        DEM__EACH(world, c) { l.elastic += world->live_elastic__[c]; }
    }
    if (!world->ledger_started__) return l;
    l.released = l.start_potential + l.added_potential - l.removed_potential - l.potential;
    l.released = l.released > 0.0 ? l.released : 0.0;
    l.error = l.kinetic + l.rotational + l.elastic + l.potential + l.normal_loss + l.sliding_loss + l.rolling_loss + l.removed - l.start -
              l.added - l.wall_work - l.external_work - l.link_work;
    return l;
}

DEM_API ptrdiff_t dem_contact_count(const dem_world *world) { return world ? world->live_count__ : 0; }

DEM_API dem_contact_info dem_get_contact(const dem_world *world, ptrdiff_t k) {
    dem_contact_info info;
    memset(&info, 0, sizeof info);
    info.gap = (double)NAN;
    if (!world || k < 0 || k >= world->live_count__) return info;
    k = dem__slot_of(world, k);
    info.i = world->live_i__[k];
    info.j = world->live_j__[k];
    info.gap = world->live_gap__[k];
    info.force = dem_vec3(world->live_out__[0][k], world->live_out__[1][k], world->live_out__[2][k]);
    info.element = world->live_element__[k];
    for (int a = 0; a < world->states__; a++) info.state[a] = world->live_state__[a][k];
    return info;
}

DEM_API void dem_set_slot_state(dem_world *world, int32_t slot, const double *state) {
    if (!world || !state || slot < 0 || slot >= world->live_count__) return;
    for (int a = 0; a < world->states__; a++) world->live_state__[a][dem__slot_of(world, slot)] = state[a];
}

DEM_API ptrdiff_t dem_link_count(const dem_world *world) { return world ? world->link_count__ : 0; }

DEM_API dem_contact_info dem_get_link(const dem_world *world, ptrdiff_t k) {
    dem_contact_info info;
    memset(&info, 0, sizeof info);
    info.gap = (double)NAN;
    if (!world || k < 0 || k >= world->link_count__) return info;
    info.i = world->link_i__[k];
    info.j = world->link_j__[k];
    info.element = world->link_element__[k];
    info.gap = world->link_gap__[k];
    info.force = dem_vec3(world->link_out__[0][k], world->link_out__[1][k], world->link_out__[2][k]);
    for (int a = 0; a < world->link_states__; a++) info.state[a] = world->link_state__[a][k];
    return info;
}

DEM_API ptrdiff_t dem_find_link(const dem_world *world, ptrdiff_t i, ptrdiff_t j, int32_t element) {
    return world && i >= 0 && i < world->count ? dem__link_of(world, i, j, element) : -1;
}

/* A bar's neighbours: element = 2 index + family, where bar `index` lies at (index - 1/2) pitch. */
DEM_API dem_apertures dem_count_apertures(const dem_world *world, int wall) {
    dem_apertures count = {0, 0, 0};
    if (!world || wall < 0 || wall >= world->walls || world->wall[wall].kind != DEM_SCREEN) return count;
    const dem_wall *s = &world->wall[wall];
    const double pitch = s->aperture + s->wire, half = 0.5 * pitch;
    const int nx = (int)(s->half_x / pitch) + 1, ny = (int)(s->half_y / pitch) + 1;
    for (int a = -nx; a <= nx; a++) {
        for (int b = -ny; b <= ny; b++) {
            double x = fabs(a * pitch) + half, y = fabs(b * pitch) + half;
            count.total += s->circular ? x * x + y * y <= s->half_x * s->half_x : x <= s->half_x && y <= s->half_y;
        }
    }
    count.free = count.total;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        if (!world->alive[i] || world->touching[i] < 2) continue;
        const dem_vec d = dem__sub(dem__at(world, i, dem__now(world, i)), s->position);
        if (!(fabs(dem__dot(d, s->axis[2])) < world->particle[i].radius)) continue;
        dem_vec normal[DEM__TOUCHES];
        int n = 0, holding = 0;
        for (int32_t c = world->wall_head__[i]; c >= 0 && n < DEM__TOUCHES; c = world->live_wall_next__[c]) {
            dem__touch touch;
            if (world->live_j__[c] != -1 - wall || !(world->live_gap__[c] < 0.0)) continue;
            dem__touch_element(s, dem__add(d, s->position), world->particle[i].radius, world->live_element__[c], &touch);
            normal[n++] = touch.normal;
        }
        if (n < 2) continue;
        const int m = s->material < world->material[i] ? s->material : world->material[i];
        const double mu = world->def.pair[m][s->material + world->material[i] - m].friction;
        const dem_vec up = s->axis[2];
        for (int a = 0; a < n; a++) { /* a wedge holds if the line between two contacts lies within both friction cones */
            for (int b = a + 1; b < n; b++) {
                const double za = dem__dot(normal[a], up), zb = dem__dot(normal[b], up);
                const dem_vec flat_a = dem__sub(normal[a], dem__scale(za, up)), flat_b = dem__sub(normal[b], dem__scale(zb, up));
                if (dem__dot(flat_a, flat_b) < -0.5 && fabs(za) <= mu * dem__length(flat_a) && fabs(zb) <= mu * dem__length(flat_b))
                    holding = 1;
            }
        }
        count.occupied++;
        count.free -= holding;
    }
    return count;
}

/* -------------------------------------------------------------------------------------------------- >>feed */

DEM_API dem_region dem_box_region(dem_vec low, dem_vec high) {
    dem_region region;
    memset(&region, 0, sizeof region);
    region.kind = DEM_REGION_BOX;
    region.low = low;
    region.high = high;
    return region;
}
DEM_API dem_region dem_cylinder_region(dem_vec bottom, dem_vec axis, double length, double radius) {
    dem_region region;
    memset(&region, 0, sizeof region);
    region.kind = DEM_REGION_CYLINDER;
    region.low = bottom;
    region.axis = axis;
    region.length = length;
    region.radius = radius;
    return region;
}
DEM_API dem_region dem_sphere_region(dem_vec centre, double radius) {
    dem_region region;
    memset(&region, 0, sizeof region);
    region.kind = DEM_REGION_SPHERE;
    region.low = centre;
    region.radius = radius;
    return region;
}

static inline int dem__is_region(const dem_region *r) {
    dem_vec unit;
    if (!r || !dem__finite_vec(r->low)) return 0;
    if (r->kind == DEM_REGION_BOX)
        return dem__finite_vec(r->high) && r->low.x <= r->high.x && r->low.y <= r->high.y && r->low.z <= r->high.z;
    if (!dem__not_negative(r->radius)) return 0;
    if (r->kind == DEM_REGION_SPHERE) return 1;
    return r->kind == DEM_REGION_CYLINDER && dem__finite_vec(r->axis) && dem__unit(r->axis, &unit) && dem__not_negative(r->length);
}

DEM_API double dem_region_volume(const dem_region *region) {
    if (!dem__is_region(region)) return (double)NAN;
    const dem_region *r = region;
    if (r->kind == DEM_REGION_BOX) return (r->high.x - r->low.x) * (r->high.y - r->low.y) * (r->high.z - r->low.z);
    return RIDDLE_PI * r->radius * r->radius * (r->kind == DEM_REGION_SPHERE ? 4.0 / 3.0 * r->radius : r->length);
}

DEM_API int dem_region_holds(const dem_region *region, dem_vec point) {
    const dem_region *r = region;
    dem_vec unit = dem_vec3(0.0, 0.0, 0.0);
    if (!dem__is_region(r)) return 0;
    const dem_vec d = dem__sub(point, r->low);
    if (r->kind == DEM_REGION_BOX)
        return point.x >= r->low.x && point.x <= r->high.x && point.y >= r->low.y && point.y <= r->high.y && point.z >= r->low.z &&
               point.z <= r->high.z;
    if (r->kind == DEM_REGION_SPHERE) return dem__dot(d, d) <= r->radius * r->radius;
    dem__unit(r->axis, &unit);
    const double along = dem__dot(d, unit);
    return along >= 0.0 && along <= r->length && dem__dot(d, d) - along * along <= r->radius * r->radius;
}

/* A box around a region. */
static inline void dem__bounds(const dem_region *r, dem_vec *low, dem_vec *high) {
    dem_vec unit = dem_vec3(0.0, 0.0, 0.0);
    if (r->kind == DEM_REGION_CYLINDER) dem__unit(r->axis, &unit);
    for (int a = 0; a < 3; a++) {
        const double at = dem_axis(r->low, a), end = r->kind == DEM_REGION_BOX ? dem_axis(r->high, a) : at + r->length * dem_axis(unit, a);
        const double out = r->kind == DEM_REGION_BOX ? 0.0 : r->radius;
        *dem_axis_of(low, a) = (at < end ? at : end) - out;
        *dem_axis_of(high, a) = (at > end ? at : end) + out;
    }
}

/* splitmix64, to [0, 1) */
static inline double dem__uniform(uint64_t *random) {
    uint64_t z = *random += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static inline dem_sizes dem__sizes(dem_size_kind kind, double scale, double spread, double smallest, double largest, int by_mass) {
    dem_sizes s;
    memset(&s, 0, sizeof s);
    s.kind = kind;
    s.by_mass = by_mass != 0;
    s.scale = scale;
    s.spread = spread;
    s.smallest = smallest;
    s.largest = largest;
    return s;
}
DEM_API dem_sizes dem_one_size(double diameter) {
    const double share = 1.0;
    return dem_size_list(1, &diameter, &share, 0);
}
DEM_API dem_sizes dem_size_list(int n, const double *diameter, const double *share, int by_mass) {
    dem_sizes s = dem__sizes(DEM_SIZES_LIST, 0.0, 0.0, 0.0, 0.0, by_mass);
    s.count = n;
    for (int k = 0; diameter && share && k < n && k < DEM_SIZES_MAX; k++) s.diameter[k] = diameter[k], s.share[k] = share[k];
    return s;
}
DEM_API dem_sizes dem_uniform_sizes(double smallest, double largest, int by_mass) {
    return dem__sizes(DEM_SIZES_UNIFORM, 0.0, 0.0, smallest, largest, by_mass);
}
DEM_API dem_sizes dem_lognormal_sizes(double median, double spread, double smallest, double largest, int by_mass) {
    return dem__sizes(DEM_SIZES_LOGNORMAL, median, spread, smallest, largest, by_mass);
}
DEM_API dem_sizes dem_rosin_rammler_sizes(double scale, double exponent, double smallest, double largest, int by_mass) {
    return dem__sizes(DEM_SIZES_ROSIN_RAMMLER, scale, exponent, smallest, largest, by_mass);
}

/* Also tells the smallest diameter and the largest. */
static inline int dem__are_sizes(const dem_sizes *s, double *smallest, double *largest) {
    *smallest = s->smallest, *largest = s->largest;
    if (s->kind == DEM_SIZES_LIST) {
        double sum = 0.0;
        if (s->count < 1 || s->count > DEM_SIZES_MAX) return 0;
        *smallest = *largest = s->diameter[0];
        for (int k = 0; k < s->count; k++) {
            if (!dem__positive(s->diameter[k]) || !dem__not_negative(s->share[k])) return 0;
            sum += s->share[k];
            *smallest = s->diameter[k] < *smallest ? s->diameter[k] : *smallest;
            *largest = s->diameter[k] > *largest ? s->diameter[k] : *largest;
        }
        return dem__positive(sum) && *largest <= 1e6 * *smallest;
    }
    if (!dem__positive(s->smallest) || !(s->largest >= s->smallest && s->largest <= 1e6 * s->smallest) || !dem__finite(s->largest))
        return 0;
    if (s->kind == DEM_SIZES_UNIFORM) return 1;
    if (!dem__positive(s->scale)) return 0;
    if (s->kind == DEM_SIZES_LOGNORMAL) return s->spread >= 1e-3 && s->spread <= 5.0;
    return s->kind == DEM_SIZES_ROSIN_RAMMLER && s->spread >= 0.1 && s->spread <= 100.0;
}

/* Logarithm of the number of spheres per ln d at d = scale e^y, but for a constant. All are concave in y. */
static inline double dem__log_number(const dem_sizes *s, double y) {
    double f = y; /* uniform */
    if (s->kind == DEM_SIZES_LOGNORMAL) f = -0.5 * y * y / (s->spread * s->spread);
    if (s->kind == DEM_SIZES_ROSIN_RAMMLER) f = s->spread * y - riddle_exp(s->spread * y);
    return s->by_mass ? f - 3.0 * y : f;
}

/* Exact: the interval of ln d is cut into pieces, each with the largest value of the density in it as a bound; draws below the density
   count. Where the density has its peak is known in closed form. */
static inline double dem__draw_continuous(const dem_sizes *s, uint64_t *random) {
    enum { PIECES = 32 };
    const double scale = s->kind == DEM_SIZES_UNIFORM ? s->largest : s->scale;
    const double low = riddle_log(s->smallest / scale), width = (riddle_log(s->largest / scale) - low) / (double)PIECES,
                 lost = s->by_mass ? 3.0 : 0.0;
    double peak = s->by_mass ? -HUGE_VAL : HUGE_VAL, bound[PIECES], total = 0.0;
    if (s->kind == DEM_SIZES_LOGNORMAL) peak = -lost * s->spread * s->spread;
    if (s->kind == DEM_SIZES_ROSIN_RAMMLER) peak = s->spread > lost ? riddle_log1p(-lost / s->spread) / s->spread : -HUGE_VAL;
    const double top = dem__log_number(s, dem__clamp(peak, low, low + (double)PIECES * width));
    for (int k = 0; k < PIECES; k++) {
        bound[k] = riddle_exp(dem__log_number(s, dem__clamp(peak, low + k * width, low + (k + 1) * width)) - top);
        total += bound[k];
    }
    for (int tries = 0; tries < 1000000; tries++) {
        double place = total * dem__uniform(random);
        int k = 0;
        while (k < PIECES - 1 && place >= bound[k]) place -= bound[k++];
        const double y = low + (k + dem__uniform(random)) * width;
        if (dem__uniform(random) * bound[k] < riddle_exp(dem__log_number(s, y) - top))
            return dem__clamp(scale * riddle_exp(y), s->smallest, s->largest);
    }
    return s->smallest; /* never seen: the ranges of the parameters leave at least 1 draw in 500 */
}

DEM_API double dem_draw_size(const dem_sizes *sizes, uint64_t *random) {
    double smallest, largest, weight[DEM_SIZES_MAX], sum = 0.0;
    const dem_sizes *s = sizes;
    if (!s || !random || !dem__are_sizes(s, &smallest, &largest)) return (double)NAN;
    if (s->kind != DEM_SIZES_LIST) return dem__draw_continuous(s, random);
    for (int k = 0; k < s->count; k++) {
        const double ratio = smallest / s->diameter[k];
        weight[k] = s->by_mass ? s->share[k] * ratio * ratio * ratio : s->share[k];
        sum += weight[k];
    }
    double place = sum * dem__uniform(random);
    int k = 0;
    while (k < s->count - 1 && place >= weight[k]) place -= weight[k++];
    while (k > 0 && weight[k] == 0.0) k--; /* the sum's rounding may lead past the last that has a share */
    return s->diameter[k];
}

DEM_API dem_feed dem_default_feed(void) {
    dem_feed feed;
    memset(&feed, 0, sizeof feed);
    feed.region = dem_box_region(dem_vec3(0.0, 0.0, 0.0), dem_vec3(0.1, 0.1, 0.1));
    feed.sizes = dem_one_size(1e-3);
    feed.tries = 1000;
    feed.random = 1;
    return feed;
}

/* Spheres in and near a region, present and new, in linked lists by level and cell. */
typedef struct dem__room {
    dem__grid grid[DEM__LEVELS_MAX];
    double smallest;
    double *centre, *radius; /* [count][3], [count] */
    int32_t *head, *next;
    ptrdiff_t count, capacity, cells;
    size_t bytes;
} dem__room;

static inline void dem__settle_in(dem__room *room, dem_vec x, double radius) {
    const ptrdiff_t k = room->count++, c = dem__cell(&room->grid[dem__level(radius, room->smallest)], x);
    room->centre[3 * k] = x.x, room->centre[3 * k + 1] = x.y, room->centre[3 * k + 2] = x.z;
    room->radius[k] = radius;
    room->next[k] = room->head[c];
    room->head[c] = (int32_t)k;
}

static inline void dem__count_in(dem__room *room, double radius) {
    dem__grid *g = &room->grid[dem__level(radius, room->smallest)];
    g->count++;
    g->widest = radius > g->widest ? radius : g->widest;
    room->capacity++;
}

/* Is sphere i near enough to a box to be in the way? Along periodic axes everything is. */
static inline int dem__in_the_way(const dem_world *w, ptrdiff_t i, dem_vec low, dem_vec high, dem_vec *x) {
    *x = dem_position(w, i);
    for (int a = 0; a < 3 && w->alive[i]; a++) {
        const double v = dem_axis(*x, a);
        if (!w->def.periodic[a] && !(v + w->particle[i].radius >= dem_axis(low, a) && v - w->particle[i].radius <= dem_axis(high, a)))
            return 0;
    }
    return w->alive[i];
}

/* Makes a room for the present spheres around a region and n new ones of given radii. */
static inline dem_status dem__make_room(dem__room *room, const dem_world *w, const dem_region *region, const double *radius, ptrdiff_t n) {
    dem_vec low, high, x;
    double widest = 0.0;
    memset(room, 0, sizeof *room);
    dem__bounds(region, &low, &high);
    room->smallest = HUGE_VAL;
    for (ptrdiff_t k = 0; k < n; k++) {
        widest = radius[k] > widest ? radius[k] : widest;
        room->smallest = radius[k] < room->smallest ? radius[k] : room->smallest;
    }
    const dem_vec out = dem_vec3(widest, widest, widest); /* a face's spheres stand out of it */
    low = dem__sub(low, out), high = dem__add(high, out);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (dem__in_the_way(w, i, low, high, &x) && w->particle[i].radius < room->smallest) room->smallest = w->particle[i].radius;
    }
    for (ptrdiff_t k = 0; k < n; k++) dem__count_in(room, radius[k]);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (dem__in_the_way(w, i, low, high, &x)) dem__count_in(room, w->particle[i].radius);
    }
    for (int level = 0; level < DEM__LEVELS_MAX; level++) {
        dem__grid *g = &room->grid[level];
        if (g->count == 0) continue;
        dem__make_grid(w, g, 2.0 * g->widest, low, high);
        g->first = room->cells;
        room->cells += (ptrdiff_t)g->n[0] * g->n[1] * g->n[2];
    }
    if (room->capacity > INT32_MAX / 8) return DEM_TOO_MANY;
    room->bytes = (size_t)room->capacity * (4 * sizeof(double) + sizeof(int32_t)) + (size_t)room->cells * sizeof(int32_t);
    room->centre = (double *)w->def.allocator.fn(w->def.allocator.user, NULL, 0, room->bytes);
    if (!room->centre) return DEM_OUT_OF_MEMORY;
    room->radius = room->centre + 3 * room->capacity;
    room->next = (int32_t *)(void *)(room->radius + room->capacity);
    room->head = room->next + room->capacity;
    for (ptrdiff_t c = 0; c < room->cells; c++) room->head[c] = -1;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (dem__in_the_way(w, i, low, high, &x)) dem__settle_in(room, x, w->particle[i].radius);
    }
    return DEM_OK;
}

/* Would a sphere there overlap another, or a wall, or be beyond an exit? */
static inline int dem__is_free(const dem_world *w, const dem__room *room, dem_vec x, double radius) {
    dem__touch touch[DEM__TOUCHES];
    double least;
    for (int k = 0; k < w->walls; k++) {
        if (w->wall[k].enabled && dem__touch_wall(&w->wall[k], x, radius, 0.0, touch, &least) > 0) return 0;
    }
    for (int level = 0; level < DEM__LEVELS_MAX; level++) {
        const dem__grid *g = &room->grid[level];
        if (g->count == 0) continue;
        int32_t first[3], cells[3];
        for (int a = 0; a < 3; a++) cells[a] = dem__cells(g, a, dem_axis(x, a), radius + g->widest, &first[a]);
        for (int32_t c = 0; c < cells[0] * cells[1] * cells[2]; c++) {
            const int32_t step[3] = {c % cells[0], c / cells[0] % cells[1], c / cells[0] / cells[1]};
            ptrdiff_t at[3];
            for (int a = 0; a < 3; a++) at[a] = first[a] + step[a] < g->n[a] ? first[a] + step[a] : first[a] + step[a] - g->n[a];
            for (int32_t q = room->head[g->first + (at[2] * g->n[1] + at[1]) * g->n[0] + at[0]]; q >= 0; q = room->next[q]) {
                const double *p = room->centre + 3 * (ptrdiff_t)q, sum = radius + room->radius[q];
                const dem_vec d = dem__apart(w, dem_vec3(x.x - p[0], x.y - p[1], x.z - p[2]));
                if (dem__dot(d, d) < sum * sum) return 0;
            }
        }
    }
    return 1;
}

/* A random place for a whole sphere in a region, or for its centre in the directions in which the region is flat. 0 if it is too small. */
static inline int dem__random_place(const dem_region *r, double radius, uint64_t *random, dem_vec *x) {
    if (r->kind == DEM_REGION_BOX) {
        for (int a = 0; a < 3; a++) {
            const double low = dem_axis(r->low, a), room = dem_axis(r->high, a) - low - 2.0 * radius;
            if (room + 2.0 * radius > 0.0 && !(room >= 0.0)) return 0;
            *dem_axis_of(x, a) = room >= 0.0 ? low + radius + room * dem__uniform(random) : low;
        }
        return 1;
    }
    const int cylinder = r->kind == DEM_REGION_CYLINDER;
    const double room = r->radius - radius, length = r->length - 2.0 * radius;
    double u[3], square;
    if (!(room >= 0.0) || (cylinder && r->length > 0.0 && !(length >= 0.0))) return 0;
    do {
        square = 0.0;
        for (int a = 0; a < 3 - cylinder; a++) {
            u[a] = 2.0 * dem__uniform(random) - 1.0;
            square += u[a] * u[a];
        }
    } while (square > 1.0);
    if (!cylinder) {
        *x = dem__add(r->low, dem__scale(room, dem_vec3(u[0], u[1], u[2])));
        return 1;
    }
    dem_wall frame;
    if (!dem__frame(&frame, r->axis, dem_vec3(1.0, 0.0, 0.0))) return 0;
    u[2] = r->length > 0.0 ? radius + length * dem__uniform(random) : 0.0;
    *x = dem__add(dem__add(r->low, dem__scale(room * u[0], frame.axis[0])),
                  dem__add(dem__scale(room * u[1], frame.axis[1]), dem__scale(u[2], frame.axis[2])));
    return 1;
}

/* Largest first. */
static inline void dem__sift_size(double *heap, ptrdiff_t root, ptrdiff_t n) {
    for (;;) {
        ptrdiff_t child = 2 * root + 1;
        if (child >= n) return;
        if (child + 1 < n && heap[child + 1] < heap[child]) child++;
        if (!(heap[child] < heap[root])) return;
        const double t = heap[root];
        heap[root] = heap[child], heap[child] = t;
        root = child;
    }
}
static inline void dem__sort_sizes(double *radius, ptrdiff_t n) {
    for (ptrdiff_t k = n / 2 - 1; k >= 0; k--) dem__sift_size(radius, k, n);
    for (ptrdiff_t k = n - 1; k > 0; k--) {
        const double t = radius[0];
        radius[0] = radius[k], radius[k] = t;
        dem__sift_size(radius, 0, k);
    }
}

/* How many spheres are due, at most `most`, drawn one after the other; their radii, if there is an array for them. The first that is
   not due waits: to leave it out would favour the small ones. */
static inline ptrdiff_t dem__draw_due(const dem_world *w, dem_feed *feed, double number, double mass, ptrdiff_t most, double *radius) {
    for (ptrdiff_t n = 0; n < most; n++) {
        if (!(feed->waiting > 0.0)) feed->waiting = dem_draw_size(&feed->sizes, &feed->random);
        const double m = dem__sphere_mass(w, feed->material, 0.5 * feed->waiting);
        if (!((double)(n + 1) <= number) || !(0.5 * m <= mass)) return n;
        if (radius) radius[n] = 0.5 * feed->waiting;
        mass -= m;
        feed->waiting = 0.0;
    }
    return most;
}

/* Places spheres: a number or, the other being infinite, a mass. At once: the largest first, those without a place are missed; else in
   the order drawn, up to the first without a place, which then waits. */
static inline dem_status dem__insert(dem_world *w, dem_feed *feed, double number, double mass, int at_once) {
    dem_allocator memory = w->def.allocator;
    dem_feed after = *feed, counted = *feed;
    dem__room room;
    ptrdiff_t placed = 0;
    const ptrdiff_t most = at_once ? INT32_MAX / 8 : 100000; /* a source that has long been blocked is not to draw all it owes each time */
    double smallest, largest;
    dem__are_sizes(&feed->sizes, &smallest, &largest);
    if (at_once && number > (double)most && mass > (double)most * dem__sphere_mass(w, feed->material, 0.5 * largest)) return DEM_TOO_MANY;
    const ptrdiff_t n = dem__draw_due(w, &counted, number, mass, most, NULL);
    if (n == INT32_MAX / 8) return DEM_TOO_MANY;
    if (n == 0) {
        *feed = counted;
        return DEM_OK;
    }
    double *radius = (double *)memory.fn(memory.user, NULL, 0, (size_t)n * 7 * sizeof *radius);
    if (!radius) return DEM_OUT_OF_MEMORY;
    double *centre = radius + n, *velocity = centre + 3 * n;
    dem__draw_due(w, &after, number, mass, most, radius);
    if (at_once) dem__sort_sizes(radius, n);
    dem_status status = dem__make_room(&room, w, &feed->region, radius, n);
    const ptrdiff_t present = room.count;
    for (ptrdiff_t k = 0; k < n && status == DEM_OK; k++) {
        const double m = dem__sphere_mass(w, feed->material, radius[k]);
        dem_vec x;
        int found = 0;
        for (int tries = 0; tries < feed->tries && !found; tries++) {
            if (!dem__random_place(&feed->region, radius[k], &after.random, &x)) break;
            x = dem__in_box(w, x); /* as dem_add_spheres will */
            found = dem__is_free(w, &room, x, radius[k]);
        }
        if (!found) {
            if (!at_once) {
                after.waiting = 2.0 * radius[k];
                break;
            }
            after.missed++;
            after.missed_mass += m;
            continue;
        }
        dem__settle_in(&room, x, radius[k]);
        after.placed_mass += m;
        if (mass < HUGE_VAL) after.due_mass -= at_once ? 0.0 : m;
        else after.due -= at_once ? 0.0 : 1.0;
    }
    /* neighbours in space become neighbours in memory */
    double *diameter = radius;
    for (ptrdiff_t c = 0; c < room.cells && status == DEM_OK; c++) {
        for (int32_t q = room.head[c]; q >= present; q = room.next[q]) {
            diameter[placed] = 2.0 * room.radius[q];
            for (int a = 0; a < 3; a++) {
                centre[3 * placed + a] = room.centre[3 * (ptrdiff_t)q + a];
                velocity[3 * placed + a] =
                    dem_axis(feed->velocity, a) + dem_axis(feed->scatter, a) * (2.0 * dem__uniform(&after.random) - 1.0);
            }
            placed++;
        }
    }
    if (room.centre) memory.fn(memory.user, room.centre, room.bytes, 0);
    if (status == DEM_OK) status = dem_add_spheres(w, placed, centre, diameter, feed->material, feed->group);
    for (ptrdiff_t k = 0; k < placed && status == DEM_OK; k++)
        dem_set_motion(w, w->count - placed + k, dem_vec3(velocity[3 * k], velocity[3 * k + 1], velocity[3 * k + 2]),
                       dem_vec3(0.0, 0.0, 0.0));
    memory.fn(memory.user, radius, (size_t)n * 7 * sizeof *radius, 0);
    if (status != DEM_OK) return status;
    after.placed += placed;
    *feed = after;
    return DEM_OK;
}

static inline int dem__is_feed(const dem_world *w, const dem_feed *f) {
    double smallest, largest;
    if (!w || !w->def.allocator.fn || !f || f->material < 0 || f->material >= w->def.materials || f->tries < 1 || f->tries > 1000000)
        return 0;
    if (!dem__is_region(&f->region) || !dem__are_sizes(&f->sizes, &smallest, &largest)) return 0;
    if (!dem__is_size(w, f->material, smallest) || !dem__is_size(w, f->material, largest)) return 0;
    if (f->waiting != 0.0 && !dem__is_size(w, f->material, f->waiting)) return 0;
    if (!dem__finite_vec(f->velocity) || !dem__not_negative(f->scatter.x) || !dem__not_negative(f->scatter.y) ||
        !dem__not_negative(f->scatter.z))
        return 0;
    return dem__finite(f->due) && dem__finite(f->due_mass);
}

DEM_API dem_status dem_fill(dem_world *world, dem_feed *feed, ptrdiff_t count) {
    if (!dem__is_feed(world, feed) || count < 0) return DEM_BAD_ARGUMENT;
    return dem__insert(world, feed, (double)count, HUGE_VAL, 1);
}
DEM_API dem_status dem_fill_mass(dem_world *world, dem_feed *feed, double mass) {
    if (!dem__is_feed(world, feed) || !dem__not_negative(mass)) return DEM_BAD_ARGUMENT;
    return dem__insert(world, feed, HUGE_VAL, mass, 1);
}

DEM_API dem_status dem_feed_number(dem_world *world, dem_feed *feed, double rate, double duration) {
    if (!dem__is_feed(world, feed) || !dem__not_negative(rate) || !dem__not_negative(duration) || !dem__finite(rate * duration))
        return DEM_BAD_ARGUMENT;
    dem_feed due = *feed;
    due.due += rate * duration;
    const dem_status status = dem__insert(world, &due, due.due, HUGE_VAL, 0);
    if (status == DEM_OK) *feed = due;
    return status;
}
DEM_API dem_status dem_feed_mass(dem_world *world, dem_feed *feed, double mass_flow, double duration) {
    if (!dem__is_feed(world, feed) || !dem__not_negative(mass_flow) || !dem__not_negative(duration) || !dem__finite(mass_flow * duration))
        return DEM_BAD_ARGUMENT;
    dem_feed due = *feed;
    due.due_mass += mass_flow * duration;
    const dem_status status = dem__insert(world, &due, HUGE_VAL, due.due_mass, 0);
    if (status == DEM_OK) *feed = due;
    return status;
}

DEM_API ptrdiff_t dem_remove_region(dem_world *world, const dem_region *region) {
    dem_world *w = world;
    ptrdiff_t removed = 0;
    if (!w || !w->def.allocator.fn || !dem__is_region(region)) return -(ptrdiff_t)DEM_BAD_ARGUMENT;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i] || !dem_region_holds(region, dem_position(w, i))) continue;
        dem__forget(w, i);
        removed++;
    }
    if (removed > 0) dem__leave_alone(w);
    return removed;
}

/* ----------------------------------------------------------------------------------------------- >>measure */

/* Unit ball where z > c. */
DEM_INLINE double dem__cap(double c) { return RIDDLE_PI / 3.0 * (1.0 - c) * (1.0 - c) * (2.0 + c); }
DEM_INLINE double dem__acos(double x) { return riddle_acos(dem__clamp(x, -1.0, 1.0)); }
DEM_INLINE double dem__root(double x) { return x > 0.0 ? sqrt(x) : 0.0; }

/* Unit ball where y > b and z > c; b, c in [-1, 1]. */
static inline double dem__wedge(double b, double c) {
    if (b < 0.0) return dem__cap(c) - dem__wedge(-b, c);
    if (c < 0.0) return dem__cap(b) - dem__wedge(b, -c);
    if (!(b * b + c * c < 1.0)) return 0.0;
    const double rb = sqrt(1.0 - b * b), rc = sqrt(1.0 - c * c), half = dem__root(1.0 - b * b - c * c); /* of the edge within */
    const double at_b = dem__acos(c / rb), at_c = dem__acos(b / rc);                                    /* half arcs on the two circles */
    const double sphere = 2.0 * (RIDDLE_PI - b * at_b - c * at_c - dem__acos(-b * c / (rb * rc)));
    return (sphere - b * (rb * rb * at_b - c * half) - c * (rc * rc * at_c - b * half)) / 3.0;
}

/* The face x = a of the corner below: its arc and its area. */
static inline double dem__corner_face(double a, double b, double c, double *arc) {
    const double square = 1.0 - a * a, r = sqrt(square);
    *arc = dem__acos(b / r) - (0.5 * RIDDLE_PI - dem__acos(c / r));
    return 0.5 * (square * *arc - c * (dem__root(square - c * c) - b) - b * (dem__root(square - b * b) - c));
}

/* Unit ball where x > a, y > b and z > c, each in [-1, 1]. */
static inline double dem__corner(double a, double b, double c) {
    if (a < 0.0) return dem__wedge(b, c) - dem__corner(-a, b, c);
    if (b < 0.0) return dem__wedge(a, c) - dem__corner(a, -b, c);
    if (c < 0.0) return dem__wedge(a, b) - dem__corner(a, b, -c);
    if (!(a * a + b * b + c * c < 1.0)) return 0.0;
    double arc[3];
    const double ra = sqrt(1.0 - a * a), rb = sqrt(1.0 - b * b), rc = sqrt(1.0 - c * c);
    const double face_a = dem__corner_face(a, b, c, &arc[0]), face_b = dem__corner_face(b, c, a, &arc[1]),
                 face_c = dem__corner_face(c, a, b, &arc[2]);
    const double turns = dem__acos(-a * b / (ra * rb)) + dem__acos(-b * c / (rb * rc)) + dem__acos(-c * a / (rc * ra));
    const double sphere = 2.0 * RIDDLE_PI - a * arc[0] - b * arc[1] - c * arc[2] - turns;
    return (sphere - a * face_a - b * face_b - c * face_c) / 3.0;
}

DEM_API double dem_ball_in_box(double radius, dem_vec low, dem_vec high) {
    double sum = 0.0, side[2][3];
    if (!dem__positive(radius) || !(low.x <= high.x && low.y <= high.y && low.z <= high.z)) return (double)NAN;
    for (int a = 0; a < 3; a++) {
        side[0][a] = dem__clamp(dem_axis(low, a) / radius, -1.0, 1.0);
        side[1][a] = dem__clamp(dem_axis(high, a) / radius, -1.0, 1.0);
    }
    for (int k = 0; k < 8; k++) {
        const int x = k & 1, y = k >> 1 & 1, z = k >> 2;
        sum += ((x + y + z) & 1 ? -1.0 : 1.0) * dem__corner(side[x][0], side[y][1], side[z][2]);
    }
    return sum > 0.0 ? sum * radius * radius * radius : 0.0;
}

/* Discs of radii q and r whose centres are a distance apart: area in common. */
static inline double dem__discs(double q, double r, double apart) {
    const double smaller = q < r ? q : r;
    if (apart <= fabs(q - r)) return RIDDLE_PI * smaller * smaller;
    if (!(apart < q + r)) return 0.0;
    const double at_q = (apart * apart + q * q - r * r) / (2.0 * apart), at_r = apart - at_q;
    return q * q * dem__acos(at_q / q) + r * r * dem__acos(at_r / r) - apart * dem__root(q * q - at_q * at_q);
}

/* Volume of a ball within a region. */
static inline double dem__ball_in(const dem_region *r, dem_vec centre, double radius) {
    const dem_vec d = dem__sub(centre, r->low);
    const double whole = 4.0 / 3.0 * RIDDLE_PI * radius * radius * radius;
    if (r->kind == DEM_REGION_BOX) return dem_ball_in_box(radius, dem__sub(r->low, centre), dem__sub(r->high, centre));
    if (r->kind == DEM_REGION_SPHERE) {
        const double apart = dem__length(d), sum = r->radius + radius, deep = sum - apart, less = r->radius - radius;
        if (apart <= fabs(less)) return less > 0.0 ? whole : dem_region_volume(r);
        return deep > 0.0 ? RIDDLE_PI * deep * deep * (apart * apart + 2.0 * apart * sum - 3.0 * less * less) / (12.0 * apart) : 0.0;
    }
    dem_vec axis = d;
    dem__unit(r->axis, &axis);
    const double along = dem__dot(d, axis), apart = dem__root(dem__dot(d, d) - along * along);
    if (apart + radius <= r->radius && along >= radius && along <= r->length - radius) return whole;
    if (apart >= r->radius + radius) return 0.0;
    /* discs across the axis, evenly in the angle, so that the ball's ends are smooth */
    const double from = dem__acos(dem__clamp(along / radius, -1.0, 1.0)),
                 to = dem__acos(dem__clamp((along - r->length) / radius, -1.0, 1.0));
    const int slices = 128;
    double sum = 0.0;
    for (int k = 0; k < slices; k++) {
        const double s = riddle_sin(from + (to - from) * (k + 0.5) / slices);
        sum += s * dem__discs(radius * s, r->radius, apart);
    }
    return sum * radius * (to - from) / slices;
}

/* Share of the line from a to b that lies in a region. */
static inline double dem__share_in(const dem_region *r, dem_vec a, dem_vec b) {
    const dem_vec way = dem__sub(b, a), d = dem__sub(a, r->low);
    double from = 0.0, to = 1.0;
    if (r->kind == DEM_REGION_BOX) {
        for (int k = 0; k < 3; k++) {
            const double at = dem_axis(a, k), v = dem_axis(way, k), low = dem_axis(r->low, k) - at, high = dem_axis(r->high, k) - at;
            if (v == 0.0 && !(low <= 0.0 && high >= 0.0)) return 0.0;
            if (v == 0.0) continue;
            const double first = (v > 0.0 ? low : high) / v, last = (v > 0.0 ? high : low) / v;
            from = first > from ? first : from, to = last < to ? last : to;
        }
        return to > from ? to - from : 0.0;
    }
    dem_vec p = d, v = way;
    if (r->kind == DEM_REGION_CYLINDER) {
        dem_vec axis = d;
        dem__unit(r->axis, &axis);
        const double at = dem__dot(d, axis), up = dem__dot(way, axis);
        if (up == 0.0 && !(at >= 0.0 && at <= r->length)) return 0.0;
        if (up != 0.0) {
            const double first = (up > 0.0 ? -at : r->length - at) / up, last = (up > 0.0 ? r->length - at : -at) / up;
            from = first > from ? first : from, to = last < to ? last : to;
        }
        p = dem__sub(p, dem__scale(at, axis)), v = dem__sub(v, dem__scale(up, axis));
    }
    const double square = dem__dot(v, v), half = dem__dot(p, v), rest = dem__dot(p, p) - r->radius * r->radius;
    if (!(square > 0.0)) return rest <= 0.0 && to > from ? to - from : 0.0;
    const double root = half * half - square * rest;
    if (!(root > 0.0)) return 0.0;
    const double first = (-half - sqrt(root)) / square, last = (-half + sqrt(root)) / square;
    from = first > from ? first : from, to = last < to ? last : to;
    return to > from ? to - from : 0.0;
}

/* Where images of what is in the box lie from it, itself first; along each periodic axis one on either side. Their number. */
static inline int dem__images(const dem_world *w, dem_vec shift[27]) {
    int n = 1;
    shift[0] = dem_vec3(0.0, 0.0, 0.0);
    for (int a = 0; a < 3; a++) {
        if (!w->def.periodic[a]) continue;
        const double length = dem_axis(w->def.high, a) - dem_axis(w->def.low, a);
        for (int k = 0; k < 2 * n; k++) {
            shift[n + k] = shift[k / 2];
            *dem_axis_of(&shift[n + k], a) += k % 2 ? length : -length;
        }
        n *= 3;
    }
    return n;
}

/* The branch of a contact, or from k = contacts on of a link: from the partner's centre, or a wall's point, to i's centre. 0 if it
   carries no force. */
static inline int dem__branch(const dem_world *w, ptrdiff_t k, dem_vec *from, dem_vec *to, dem_vec *force) {
    const dem_contact_info c = k < w->live_count__ ? dem_get_contact(w, k) : dem_get_link(w, k - w->live_count__);
    *to = dem_position(w, c.i);
    *force = c.force;
    if (c.j >= 0) *from = dem__sub(*to, dem__apart(w, dem__sub(*to, dem_position(w, c.j))));
    else {
        dem__touch touch;
        dem__touch_place(w, k < w->live_count__ ? dem__slot_of(w, k) : -1, &w->wall[-1 - c.j], *to, w->particle[c.i].radius, c.element,
                         &touch);
        *from = dem__sub(*to, dem__scale(w->particle[c.i].radius + touch.gap, touch.normal));
    }
    return dem__dot(c.force, c.force) > 0.0;
}

DEM_INLINE void dem__add_stress(double (*stress)[3], double weight, dem_vec f, dem_vec l) {
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) stress[a][b] += weight * dem_axis(f, a) * dem_axis(l, b);
    }
}

DEM_API dem_status dem_measure_region(const dem_world *world, const dem_region *region, dem_measure *measure) {
    const dem_world *w = world;
    dem_measure m;
    dem_vec low, high, shift[27];
    if (!w || !w->def.allocator.fn || !measure || !dem__is_region(region)) return DEM_BAD_ARGUMENT;
    const int images = dem__images(w, shift);
    memset(&m, 0, sizeof m);
    const double volume = dem_region_volume(region), share = volume > 0.0 ? 1.0 / volume : (double)NAN;
    dem__bounds(region, &low, &high);
    for (int pass = 0; pass < 2; pass++) {
        for (ptrdiff_t i = 0; i < w->count; i++) {
            const dem_vec at = dem_position(w, i), v = dem_velocity(w, i);
            const double r = w->particle[i].radius;
            if (!w->alive[i]) continue;
            for (int image = 0; image < images; image++) {
                const dem_vec x = dem__add(at, shift[image]);
                if (!(x.x + r >= low.x && x.x - r <= high.x && x.y + r >= low.y && x.y - r <= high.y && x.z + r >= low.z &&
                      x.z - r <= high.z))
                    continue;
                const int inside = dem_region_holds(region, x);
                if (pass == 0) m.solid_fraction += dem__ball_in(region, x, r) * share;
                if (pass == 0 && inside) {
                    m.count++;
                    m.mass += w->particle[i].mass;
                    m.coordination += w->touching[i];
                    m.velocity = dem__add(m.velocity, dem__scale(w->particle[i].mass, v));
                }
                if (pass == 1 && inside) {
                    const dem_vec u = dem__sub(v, m.velocity);
                    m.granular_temperature += w->particle[i].mass * dem__dot(u, u);
                    dem__add_stress(m.kinetic_stress, w->particle[i].mass * share, u, u);
                }
            }
        }
        const double inverse = m.count > 0 ? 1.0 / m.mass : 0.0;
        if (pass == 0) m.velocity = dem__scale(inverse, m.velocity);
        if (pass == 1) m.granular_temperature *= inverse / 3.0;
    }
    if (m.count > 0) m.coordination /= (double)m.count;
    for (ptrdiff_t k = 0; k < w->live_count__ + w->link_count__; k++) {
        dem_vec from, to, force;
        if (!dem__branch(w, k, &from, &to, &force)) continue;
        for (int image = 0; image < images; image++) {
            const double part = dem__share_in(region, dem__add(from, shift[image]), dem__add(to, shift[image]));
            if (part > 0.0) dem__add_stress(m.contact_stress, part * share, force, dem__sub(to, from));
        }
    }
    *measure = m;
    return DEM_OK;
}

static inline int dem__are_cells(const dem_cells *c) {
    double number = 1.0;
    if (!c || !dem__finite_vec(c->low) || !dem__finite_vec(c->high)) return 0;
    for (int a = 0; a < 3; a++) {
        if (c->n[a] < 1 || c->n[a] > 100000 || !(dem_axis(c->high, a) > dem_axis(c->low, a)) || !dem__not_negative(c->width[a])) return 0;
        number *= c->n[a];
    }
    return number < 1073741824.0;
}

/* Integral of the kernel up to u. */
DEM_INLINE double dem__up_to(double u) {
    u = dem__clamp(u, -1.0, 1.0);
    return 0.5 + 0.0625 * u * (15.0 - u * u * (10.0 - 3.0 * u * u));
}

/* The cells of an axis in which a point at v counts: first and last. 0 if none. */
static inline int dem__cells_of(const dem_cells *c, int a, double v, int *first, int *last) {
    const double low = dem_axis(c->low, a), high = dem_axis(c->high, a), inverse = c->n[a] / (high - low), reach = c->width[a];
    if (!(v + reach >= low && v - reach <= high)) return 0;
    const double from = floor((v - reach - low) * inverse), to = floor((v + reach - low) * inverse), most = (double)(c->n[a] - 1);
    *first = from > 0.0 ? (int)(from < most ? from : most) : 0, *last = to > 0.0 ? (int)(to < most ? to : most) : 0; /* NaN too */
    return 1;
}

/* Share of a point at v that counts in cell k of an axis. */
DEM_INLINE double dem__share_of(const dem_cells *c, int a, int k, double v) {
    if (c->width[a] == 0.0) return 1.0;
    const double low = dem_axis(c->low, a), size = (dem_axis(c->high, a) - low) / c->n[a], at = low + k * size - v,
                 inverse = 1.0 / c->width[a];
    return dem__up_to((at + size) * inverse) - dem__up_to(at * inverse);
}

/* What a point carries, spread over the cells around it. */
typedef struct dem__load {
    double mass, stress;            /* [kg]; weight of a branch's point */
    dem_vec velocity, force, along; /* of a sphere; of a branch */
} dem__load;

static inline void dem__smear(const dem_world *w, const dem_cells *c, dem_field *field, dem_vec at, const dem__load *load) {
    dem_vec shift[27];
    const int images = dem__images(w, shift);
    for (int image = 0; image < images; image++) {
        int first[3], last[3];
        const dem_vec x = dem__add(at, shift[image]);
        if (!dem__cells_of(c, 0, x.x, &first[0], &last[0]) || !dem__cells_of(c, 1, x.y, &first[1], &last[1]) ||
            !dem__cells_of(c, 2, x.z, &first[2], &last[2]))
            continue;
        for (int kz = first[2]; kz <= last[2]; kz++) {
            const double sz = dem__share_of(c, 2, kz, x.z);
            for (int ky = first[1]; ky <= last[1]; ky++) {
                const double sy = sz * dem__share_of(c, 1, ky, x.y);
                for (int kx = first[0]; kx <= last[0]; kx++) {
                    const double share = sy * dem__share_of(c, 0, kx, x.x), mass = share * load->mass;
                    dem_field *f = &field[((ptrdiff_t)kz * c->n[1] + ky) * c->n[0] + kx];
                    f->density += mass;
                    f->momentum = dem__add(f->momentum, dem__scale(mass, load->velocity));
                    if (load->mass > 0.0) dem__add_stress(f->kinetic_stress, mass, load->velocity, load->velocity);
                    else dem__add_stress(f->contact_stress, share * load->stress, load->force, load->along);
                }
            }
        }
    }
}

DEM_API dem_status dem_coarse_grain(const dem_world *world, const dem_cells *cells, dem_field *field) {
    static const double node[4] = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674, 0.96028985649753623};
    static const double weight[4] = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447, 0.10122853629037626};
    const dem_world *w = world;
    const dem_cells *c = cells;
    dem__load load;
    if (!w || !w->def.allocator.fn || !field || !dem__are_cells(c)) return DEM_BAD_ARGUMENT;
    const ptrdiff_t number = (ptrdiff_t)c->n[0] * c->n[1] * c->n[2];
    const double volume = (c->high.x - c->low.x) * (c->high.y - c->low.y) * (c->high.z - c->low.z) / (double)number;
    memset(field, 0, (size_t)number * sizeof *field);
    memset(&load, 0, sizeof load);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        load.mass = w->particle[i].mass;
        load.velocity = dem_velocity(w, i);
        dem__smear(w, c, field, dem_position(w, i), &load);
    }
    memset(&load, 0, sizeof load);
    for (ptrdiff_t k = 0; k < w->live_count__ + w->link_count__; k++) {
        dem_vec from, to;
        if (!dem__branch(w, k, &from, &to, &load.force)) continue;
        load.along = dem__sub(to, from);
        for (int p = 0; p < 8; p++) {
            const double at = 0.5 + (p < 4 ? -0.5 : 0.5) * node[p % 4];
            load.stress = 0.5 * weight[p % 4];
            dem__smear(w, c, field, dem__add(from, dem__scale(at, load.along)), &load);
        }
    }
    for (ptrdiff_t k = 0; k < number; k++) {
        dem_field *f = &field[k];
        if (f->density > 0.0) dem__add_stress(f->kinetic_stress, -1.0 / f->density, f->momentum, f->momentum);
        f->density /= volume;
        f->momentum = dem__scale(1.0 / volume, f->momentum);
        for (int a = 0; a < 9; a++) f->contact_stress[a / 3][a % 3] /= volume, f->kinetic_stress[a / 3][a % 3] /= volume;
    }
    return DEM_OK;
}

DEM_API ptrdiff_t dem_histogram(const dem_world *world, dem_quantity quantity, double low, double high, int bins, double *count) {
    const dem_world *w = world;
    ptrdiff_t outside = 0;
    if (!w || !w->def.allocator.fn || !count || bins < 1 || !(low < high) || !dem__finite(high - low)) return -(ptrdiff_t)DEM_BAD_ARGUMENT;
    if (quantity != DEM_CONTACT_FORCE && quantity != DEM_CONTACT_OVERLAP) return -(ptrdiff_t)DEM_BAD_ARGUMENT;
    for (int k = 0; k < bins; k++) count[k] = 0.0;
    for (ptrdiff_t k = 0; k < w->live_count__; k++) {
        const dem_contact_info c = dem_get_contact(w, k);
        if (!(c.gap < 0.0)) continue;
        const double value = quantity == DEM_CONTACT_FORCE ? dem__length(c.force) : -c.gap,
                     bin = floor((value - low) / (high - low) * bins);
        if (value >= low && value <= high) count[bin < (double)bins ? (int)bin : bins - 1] += 1.0;
        else outside++;
    }
    return outside;
}

DEM_API dem_status dem_residence(const dem_world *world, const dem_region *region, ptrdiff_t n, double *entered, double *stayed) {
    const dem_world *w = world;
    if (!w || !w->def.allocator.fn || !dem__is_region(region) || n < 0 || (n > 0 && (!entered || !stayed))) return DEM_BAD_ARGUMENT;
    for (ptrdiff_t k = 0; k < w->passed_count; k++) {
        const dem_passed *p = &w->passed[k];
        if (p->id >= (uint64_t)n || !dem__finite(entered[p->id])) continue;
        stayed[p->id] += p->time - entered[p->id];
        entered[p->id] = (double)NAN;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const uint64_t id = w->id[i];
        if (!w->alive[i] || id >= (uint64_t)n) continue;
        const int inside = dem_region_holds(region, dem_position(w, i)), was = dem__finite(entered[id]);
        if (was && !inside) stayed[id] += w->time - entered[id];
        if (was != inside) entered[id] = inside ? w->time : (double)NAN;
    }
    return DEM_OK;
}

DEM_API dem_status dem_count_in_cells(const dem_world *world, const dem_cells *cells, int group, double *of_group, double *of_all) {
    const dem_world *w = world;
    if (!w || !w->def.allocator.fn || !dem__are_cells(cells) || !of_group || !of_all) return DEM_BAD_ARGUMENT;
    dem_cells sharp = *cells;
    const ptrdiff_t number = (ptrdiff_t)sharp.n[0] * sharp.n[1] * sharp.n[2];
    sharp.width[0] = sharp.width[1] = sharp.width[2] = 0.0;
    for (ptrdiff_t k = 0; k < number; k++) of_group[k] = of_all[k] = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_vec x = dem_position(w, i);
        int at[3], last;
        if (!w->alive[i] || !dem__cells_of(&sharp, 0, x.x, &at[0], &last) || !dem__cells_of(&sharp, 1, x.y, &at[1], &last) ||
            !dem__cells_of(&sharp, 2, x.z, &at[2], &last))
            continue;
        const ptrdiff_t k = ((ptrdiff_t)at[2] * sharp.n[1] + at[1]) * sharp.n[0] + at[0];
        of_all[k] += 1.0;
        of_group[k] += w->group[i] == group ? 1.0 : 0.0;
    }
    return DEM_OK;
}

/* The expected variance is that of drawing without putting back: p q (N - n)/(n (N - 1)) for a sample of n out of N. */
DEM_API dem_mixing dem_mixing_of(ptrdiff_t samples, const double *of_group, const double *of_all) {
    const double none = (double)NAN;
    dem_mixing m = {none, none, none, none, none, none};
    double group = 0.0, all = 0.0, used = 0.0, square = 0.0;
    if (samples < 1 || !of_group || !of_all) return m;
    for (ptrdiff_t k = 0; k < samples; k++) {
        if (!(of_group[k] >= 0.0 && of_all[k] >= of_group[k]) || !dem__finite(of_all[k])) return m;
        group += of_group[k], all += of_all[k], used += of_all[k] > 0.0 ? 1.0 : 0.0;
    }
    const double p = group / all;
    if (!(p > 0.0 && p < 1.0)) return m;
    for (ptrdiff_t k = 0; k < samples; k++) {
        const double d = of_all[k] > 0.0 ? of_group[k] / of_all[k] - p : 0.0;
        square += of_all[k] * d * d;
    }
    m.share = p;
    m.separated = p * (1.0 - p);
    m.random = m.separated * (used - 1.0) / (all - 1.0);
    m.variance = square / all;
    m.lacey = (m.separated - m.variance) / (m.separated - m.random);
    m.segregation = m.variance / m.separated;
    return m;
}

DEM_API double dem_unlike_contacts(const dem_world *world, int group) {
    double unlike = 0.0, all = 0.0, ends = 0.0;
    if (!world) return (double)NAN;
    DEM__EACH(world, k) {
        const int32_t i = world->live_i__[k], j = world->live_j__[k];
        if (j < 0 || !(world->live_gap__[k] < 0.0)) continue;
        const int a = world->group[i] == group, b = world->group[j] == group;
        unlike += a != b, ends += a + b, all += 1.0;
    }
    const double p = ends / (2.0 * all);
    return unlike / (all * 2.0 * p * (1.0 - p));
}

/* ---- bytes in and out: one description serves saving, loading and hashing ---- */

typedef struct dem__stream {
    unsigned char *to;         /* saving, or NULL to count */
    const unsigned char *from; /* loading */
    size_t size, at;
    uint64_t hash;
    int loading, failed;
} dem__stream;

static inline void dem__u64(dem__stream *s, uint64_t *v) {
    unsigned char byte[8];
    if (s->loading) {
        if (s->size - s->at < 8) {
            s->failed = 1;
            *v = 0;
            return;
        }
        *v = 0;
        for (int k = 0; k < 8; k++) *v |= (uint64_t)s->from[s->at + (size_t)k] << (8 * k);
    }
    for (int k = 0; k < 8; k++) {
        byte[k] = (unsigned char)(*v >> (8 * k) & 255u);
        s->hash = (s->hash ^ byte[k]) * 0x100000001b3u;
    }
    if (!s->loading && s->to && s->at + 8 <= s->size) memcpy(s->to + s->at, byte, 8);
    s->at += 8;
}

static inline void dem__f64(dem__stream *s, double *v) {
    uint64_t bits;
    memcpy(&bits, v, sizeof bits);
    dem__u64(s, &bits);
    memcpy(v, &bits, sizeof bits);
}

static inline void dem__i64(dem__stream *s, int64_t *v) {
    uint64_t bits = (uint64_t)*v;
    dem__u64(s, &bits);
    *v = (int64_t)bits;
}

static inline void dem__i32(dem__stream *s, int32_t *v) {
    int64_t wide = *v;
    dem__i64(s, &wide);
    if (wide < INT32_MIN || wide > INT32_MAX) s->failed = 1;
    *v = (int32_t)wide;
}

static inline void dem__vecs(dem__stream *s, dem_vec *v, size_t n) {
    for (size_t k = 0; k < n; k++) dem__f64(s, &v[k].x), dem__f64(s, &v[k].y), dem__f64(s, &v[k].z);
}
static inline void dem__ints(dem__stream *s, int *v, size_t n) {
    for (size_t k = 0; k < n; k++) {
        int32_t a = v[k];
        dem__i32(s, &a);
        v[k] = a;
    }
}

static inline void dem__stream_def(dem__stream *s, dem_def *d) {
    int32_t cookie = (int32_t)d->cookie;
    dem__i32(s, &cookie);
    d->cookie = (uint32_t)cookie;
    dem__ints(s, &d->materials, 1), dem__ints(s, &d->threads, 1), dem__ints(s, &d->skip, 1), dem__ints(s, d->periodic, 3);
    dem__f64(s, &d->dt), dem__f64(s, &d->skin);
    dem__vecs(s, &d->gravity, 1), dem__vecs(s, &d->low, 1), dem__vecs(s, &d->high, 1);
    for (int a = 0; a < DEM_MATERIALS_MAX; a++) {
        dem__f64(s, &d->material[a].density), dem__f64(s, &d->material[a].young_modulus), dem__f64(s, &d->material[a].poisson_ratio);
        for (int b = 0; b < DEM_MATERIALS_MAX; b++) {
            dem_pair_def *p = &d->pair[a][b];
            int mode = (int)p->mode;
            dem__f64(s, &p->stiffness), dem__f64(s, &p->tangential_ratio), dem__f64(s, &p->restitution), dem__f64(s, &p->friction);
            dem__f64(s, &p->rolling), dem__f64(s, &p->tangential_damping);
            dem__ints(s, &mode, 1);
            p->mode = mode == (int)DEM_NAIVE ? DEM_NAIVE : DEM_CLIPPED;
        }
    }
}

static inline void dem__stream_wall(dem__stream *s, dem_wall *w) {
    int *flags[] = {&w->kind, &w->material, &w->enabled, &w->inside, &w->profile, &w->circular, &w->slides, &w->drive};
    for (size_t k = 0; k < sizeof flags / sizeof *flags; k++) dem__ints(s, flags[k], 1);
    double *numbers[] = {
        &w->radius,    &w->high_radius, &w->length,    &w->aperture,     &w->wire,        &w->half_x,      &w->half_y,
        &w->frequency, &w->spin,        &w->spin_rate, &w->coordinate,   &w->rate,        &w->rate_change, &w->inertia,
        &w->load,      &w->damping,     &w->interval,  &w->motion_start, &w->speed_bound, &w->spin_bound,  &w->acceleration_bound,
        &w->side_bound};
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) dem__f64(s, numbers[k]);
    dem__vecs(s, w->axis, 3), dem__vecs(s, w->rest_axis, 3);
    dem_vec *vectors[] = {&w->origin,   &w->belt,     &w->amplitude,    &w->phase, &w->drift,  &w->spin_axis, &w->spin_centre,
                          &w->position, &w->velocity, &w->acceleration, &w->force, &w->torque, &w->impulse};
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++) dem__vecs(s, vectors[k], 1);
}

/* Particles present and contacts; remap__[i] must be the index among those present. */
static inline void dem__stream_state(dem__stream *s, dem_world *w, const int32_t *remap, int with_forces) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        dem_particle *p = &w->particle[i];
        dem__vecs(s, &p->x, 1), dem__vecs(s, &p->v, 1), dem__vecs(s, &p->a, 1), dem__vecs(s, &p->spin, 1),
            dem__vecs(s, &w->spin_rate[i], 1);
        dem__f64(s, &p->radius), dem__f64(s, &p->mass);
        for (int a = 0; a < 6; a++) dem__f64(s, &w->load__[i][a]);
        dem__i64(s, &w->particle[i].origin);
        dem__u64(s, &w->id[i]);
        dem__i32(s, &w->material[i]), dem__i32(s, &w->group[i]);
        for (int a = 0; a < 6; a++) {
            if (w->links_on__) dem__f64(s, &w->external__[i][a]);
            else if (s->loading) w->external__[i][a] = w->load__[i][a];
        }
        for (int a = 0; a < 6 && w->links_on__ && with_forces; a++) dem__f64(s, &w->linked__[i][a]);
        if (w->links_on__) dem__i32(s, &w->link_loaded__[i]);
    }
    for (ptrdiff_t k = 0; k < w->link_count__; k++) {
        int32_t i = remap ? remap[w->link_i__[k]] : w->link_i__[k], j = w->link_j__[k];
        if (remap && j >= 0) j = remap[j];
        dem__i32(s, &i), dem__i32(s, &j), dem__i32(s, &w->link_element__[k]);
        if (s->loading) w->link_i__[k] = i, w->link_j__[k] = j;
        for (int a = 0; a < w->link_states__; a++) dem__f64(s, &w->link_state__[a][k]);
    }
    DEM__EACH(w, c) {
        int32_t i = remap ? remap[w->live_i__[c]] : w->live_i__[c], j = w->live_j__[c];
        if (remap && j >= 0) j = remap[j];
        dem__i32(s, &i), dem__i32(s, &j), dem__i32(s, &w->live_element__[c]);
        if (s->loading) w->live_i__[c] = i, w->live_j__[c] = j;
        dem__f64(s, &w->live_gap__[c]), dem__f64(s, &w->live_force__[c]);
        for (int a = 0; a < w->states__; a++) dem__f64(s, &w->live_state__[a][c]);
        if (!with_forces) continue;
        for (int a = 0; w->places__ && a < 4; a++) dem__f64(s, &w->live_place__[a][c]);
        for (int a = 0; a < 9; a++) dem__f64(s, &w->live_out__[a][c]);
        if (w->ledger_on__) {
            dem__f64(s, &w->live_elastic__[c]);
            for (int a = 0; a < 3; a++) dem__f64(s, &w->live_power__[a][c]);
        }
    }
}

static inline void dem__number_present(const dem_world *w) {
    int32_t n = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) w->remap__[i] = w->alive[i] ? n++ : -1;
}

DEM_API uint64_t dem_hash(const dem_world *world) {
    dem__stream s;
    memset(&s, 0, sizeof s);
    s.hash = 0xcbf29ce484222325u;
    if (!world || !world->def.allocator.fn) return s.hash;
    dem_world w = *world; /* shares the arrays; a stream that saves changes none of them */
    dem__number_present(&w);
    dem__i64(&s, &w.step);
    for (int k = 0; k < w.walls; k++) {
        if (w.wall[k].drive >= DEM_FORCE_CONTROLLED) dem__f64(&s, &w.wall[k].coordinate), dem__f64(&s, &w.wall[k].rate);
    }
    dem__stream_state(&s, &w, w.remap__, 0);
    return s.hash;
}

static inline void dem__stream_sections(dem__stream *s, dem_world *w, int64_t live, int64_t present) {
    const int64_t all = live + DEM_BLOCK;
    ptrdiff_t first = 0;
    dem__ints(s, &w->sections__, 1);
    if (w->sections__ < 1 || w->sections__ > DEM__SECTIONS) s->failed = 1;
    for (int q = 0; q < w->sections__ && !s->failed; q++) {
        dem__section *in = &w->section__[q];
        int64_t of = in->live, room = in->room;
        int32_t from = in->from;
        if (!s->loading && from > 0) from = dem__remapped(w, from);
        dem__i64(s, &of), dem__i64(s, &room), dem__i32(s, &from);
        if (of < 0 || of > live || room < 0 || room > 64 * (all + present) || (q < w->sections__ - 1 && of > room)) s->failed = 1;
        if (!s->loading || s->failed) continue;
        in->first = first, in->live = (ptrdiff_t)of, in->room = (ptrdiff_t)room, in->from = q < w->sections__ - 1 ? from : 0;
        first += in->room;
        live -= of;
    }
    if (s->loading && live != 0) s->failed = 1;
}

static inline void dem__stream_head(dem__stream *s, dem_world *w, int64_t *present) {
    uint64_t magic = 0x0a1a64656d52u, version = DEM_FORMAT;
    dem__u64(s, &magic), dem__u64(s, &version);
    if (magic != 0x0a1a64656d52u || version != DEM_FORMAT) s->failed = 1;
    dem__stream_def(s, &w->def);
    dem__i64(s, &w->step), dem__f64(s, &w->time), dem__f64(s, &w->start_time__), dem__i64(s, &w->start_step__), dem__f64(s, &w->target__);
    dem__u64(s, &w->next_id__);
    dem__i64(s, &w->particle_steps), dem__i64(s, &w->contact_steps), dem__i64(s, &w->looks), dem__i64(s, &w->rebuilds);
    const int64_t counts[] = {w->step, w->start_step__, w->particle_steps, w->contact_steps, w->looks, w->rebuilds};
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) s->failed |= s->loading && !(counts[k] >= 0 && counts[k] < INT64_MAX / 4);
    int *flags[] = {&w->walls,      &w->fresh__,  &w->ledger_on__, &w->ledger_started__,
                    &w->loads_on__, &w->states__, &w->links_on__,  &w->link_states__};
    for (size_t k = 0; k < sizeof flags / sizeof *flags; k++) dem__ints(s, flags[k], 1);
    if (w->walls < 0 || w->walls > DEM_WALLS_MAX || w->states__ < 0 || w->states__ > DEM_STATE_MAX) s->failed = 1;
    if (w->link_states__ < 0 || w->link_states__ > DEM_STATE_MAX) s->failed = 1;
    dem__f64(s, &w->link_interval__), dem__f64(s, &w->link_near__);
    for (int k = 0; k < w->walls && !s->failed; k++) dem__stream_wall(s, &w->wall[k]);
    dem_energy_ledger *l = &w->ledger__;
    double *sums[] = {&l->normal_loss, &l->sliding_loss, &l->rolling_loss, &l->wall_work,       &l->link_work,       &l->external_work,
                      &l->added,       &l->removed,      &l->start,        &l->start_potential, &l->added_potential, &l->removed_potential};
    for (size_t k = 0; k < sizeof sums / sizeof *sums; k++) dem__f64(s, sums[k]);
    int64_t live = w->live_count__, passed = w->passed_count, links = w->link_count__;
    dem__i64(s, present), dem__i64(s, &live), dem__i64(s, &passed), dem__i64(s, &links);
    if (links < 0 || links > INT32_MAX / 4 || !dem__not_negative(w->link_near__) || !dem__not_negative(w->link_interval__)) s->failed = 1;
    if (live < 0 || passed < 0 || *present < 0 || live > INT32_MAX / 4 || *present > INT32_MAX / 4 || passed > INT32_MAX) s->failed = 1;
    dem__stream_sections(s, w, live, *present);
    w->live_count__ = (ptrdiff_t)live;
    w->passed_count = (ptrdiff_t)passed;
    w->link_count__ = (ptrdiff_t)links;
}

static inline void dem__stream_passed(dem__stream *s, dem_world *w) {
    for (ptrdiff_t k = 0; k < w->passed_count && !s->failed; k++) {
        dem_passed *p = &w->passed[k];
        dem__f64(s, &p->time), dem__f64(s, &p->diameter), dem__vecs(s, &p->position, 1), dem__vecs(s, &p->velocity, 1);
        dem__u64(s, &p->id), dem__i32(s, &p->group), dem__i32(s, &p->exit);
    }
}

/* The triangles of meshes, which a tree is made from anew. */
static inline dem_status dem__stream_mesh(dem__stream *s, dem_wall *a, const dem_allocator *memory) {
    int64_t vertices = s->loading ? 0 : a->tree->vertices, triangles = s->loading ? 0 : a->tree->triangles;
    dem_vec *vertex = s->loading ? NULL : a->tree->vertex;
    int32_t *corner = s->loading ? NULL : a->tree->corner;
    size_t bytes = 0;
    dem_status status = DEM_OK;
    dem__i64(s, &vertices), dem__i64(s, &triangles);
    if (s->loading) {
        const int64_t room = (int64_t)((s->size - s->at) / 24);
        if (s->failed || vertices < 1 || triangles < 1 || vertices > room || triangles > room - vertices) return DEM_BAD_DATA;
        bytes = (size_t)vertices * sizeof *vertex + 3 * (size_t)triangles * sizeof *corner;
        vertex = (dem_vec *)memory->fn(memory->user, NULL, 0, bytes);
        if (!vertex) return DEM_OUT_OF_MEMORY;
        corner = (int32_t *)(void *)(vertex + vertices);
    }
    dem__vecs(s, vertex, (size_t)vertices);
    for (int64_t k = 0; k < 3 * triangles; k++) dem__i32(s, &corner[k]);
    if (!s->loading) return DEM_OK;
    for (int64_t k = 0; k < vertices; k++) {
        if (!(fabs(vertex[k].x) < 1e50 && fabs(vertex[k].y) < 1e50 && fabs(vertex[k].z) < 1e50)) s->failed = 1;
    }
    for (int64_t k = 0; k < 3 * triangles; k++) {
        if (corner[k] < 0 || corner[k] >= vertices) s->failed = 1;
    }
    if (s->failed) status = DEM_BAD_DATA;
    else a->tree = dem__make_tree(memory, (ptrdiff_t)vertices, vertex, (ptrdiff_t)triangles, corner, &status);
    memory->fn(memory->user, vertex, bytes, 0);
    return status == DEM_BAD_ARGUMENT ? DEM_BAD_DATA : status;
}

static inline dem_status dem__stream_meshes(dem__stream *s, dem_world *w) {
    for (int k = 0; k < w->walls; k++) {
        if (w->wall[k].kind != DEM_MESH) continue;
        const dem_status status = dem__stream_mesh(s, &w->wall[k], &w->def.allocator);
        if (status != DEM_OK) return status;
    }
    return DEM_OK;
}

DEM_API size_t dem_save(const dem_world *world, void *buffer, size_t capacity) {
    dem__stream s;
    if (!world || !world->def.allocator.fn) return 0;
    for (int pass = 0; pass < 2; pass++) {
        dem_world w = *world;
        int64_t present = w.count - w.dropped__;
        uint64_t check;
        memset(&s, 0, sizeof s);
        s.hash = 0xcbf29ce484222325u;
        s.to = pass && buffer ? (unsigned char *)buffer : NULL;
        s.size = capacity;
        dem__number_present(&w);
        dem__stream_head(&s, &w, &present);
        dem__stream_state(&s, &w, w.remap__, 1);
        dem__stream_passed(&s, &w);
        dem__stream_meshes(&s, &w);
        check = s.hash;
        dem__u64(&s, &check);
        if (s.at > capacity) break; /* too small: nothing is written */
    }
    return s.at;
}

/* Every index and number in loaded data that the code relies on. */
static inline int dem__loaded_is_sound(const dem_world *w) {
    ptrdiff_t n = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!dem__positive(w->particle[i].radius) || !dem__positive(w->particle[i].mass) || w->material[i] < 0 ||
            w->material[i] >= w->def.materials || w->particle[i].origin > w->step || w->particle[i].origin < 0)
            return 0;
        if (i > 0 && w->id[i] <= w->id[i - 1]) return 0;
    }
    DEM__EACH(w, c) {
        const int32_t i = w->live_i__[c], j = w->live_j__[c];
        if (i < 0 || i >= w->count || j >= w->count || j < -w->walls || (j >= 0 && j <= i)) return 0;
        if (j < 0 && w->wall[-1 - j].kind == DEM_MESH && (w->live_element__[c] < 0 || w->live_element__[c] >= DEM__NUMBERS)) return 0;
        if (w->particle[i].origin != w->step || (j >= 0 && w->particle[j].origin != w->step)) return 0;
        w->slots__[n++] = (int32_t)c;
    }
    dem__sort(w, w->slots__, n); /* none is there twice */
    for (ptrdiff_t c = 1; c < n; c++) {
        if (!dem__before(w, w->slots__[c - 1], w->slots__[c])) return 0;
    }
    for (ptrdiff_t k = 0; k < w->link_count__; k++) {
        const int32_t i = w->link_i__[k], j = w->link_j__[k];
        if (i < 0 || i >= w->count || j >= w->count || j < -w->walls || i == j) return 0;
    }
    for (int k = 0; k < w->walls; k++) {
        const dem_wall *a = &w->wall[k];
        if (a->material < 0 || a->material >= w->def.materials || a->kind < DEM_PLANE || a->kind > DEM_MESH) return 0;
        if (a->kind == DEM_SCREEN && !dem__is_deck(a)) return 0;
        if (a->kind == DEM_CONE && !(a->length > 0.0 && a->radius + a->high_radius > 0.0)) return 0;
        if (a->drive < DEM_KINEMATIC || a->drive > DEM_TORQUE_CONTROLLED || (a->drive == DEM_PRESCRIBED && !(a->interval > 0.0))) return 0;
        if (a->drive >= DEM_FORCE_CONTROLLED && !(a->inertia > 0.0)) return 0;
    }
    return 1;
}

DEM_API dem_status dem_load(dem_world *world, const void *buffer, size_t size, const dem_allocator *allocator) {
    dem_world *w = world;
    dem__stream s;
    int64_t present = 0;
    uint64_t check, found = 0;
    if (!w || !buffer) return DEM_BAD_ARGUMENT;
    memset(w, 0, sizeof *w);
    memset(&s, 0, sizeof s);
    s.hash = 0xcbf29ce484222325u;
    s.from = (const unsigned char *)buffer;
    s.size = size;
    s.loading = 1;
    dem_allocator memory;
    memory.fn = dem__default_allocator;
    memory.user = NULL;
    if (allocator) memory = *allocator;
    w->def.allocator = memory;
    dem__stream_head(&s, w, &present);
    const size_t per_particle = 27 * 8, per_contact = 14 * 8;
    if (s.failed || dem__bad_field(&w->def) || (size_t)present > size / per_particle || (size_t)w->live_count__ > size / per_contact ||
        (size_t)w->passed_count > size / 80 || (size_t)w->link_count__ > size / 24) {
        memset(w, 0, sizeof *w);
        return DEM_BAD_DATA;
    }
    dem__array list[DEM__ARRAYS_MAX];
    ptrdiff_t live = w->live_count__, passed = w->passed_count, links = w->link_count__;
    int enough;
    w->live_count__ = w->passed_count = w->link_count__ = 0;
    for (int k = 0; k < w->walls; k++) {
        w->meshes__ += w->wall[k].kind == DEM_MESH;
        w->places__ += w->wall[k].kind == DEM_MESH || w->wall[k].kind == DEM_CONE;
        w->controls__ |= w->wall[k].drive >= DEM_FORCE_CONTROLLED;
    }
    enough = dem__grow_group(w, list, dem__particle_arrays(w, list), &w->particle_block__, &w->particle_bytes__, &w->capacity__,
                             (ptrdiff_t)present + 1);
    enough = enough && dem__grow_live(w, dem__next_slot(w) + 1);
    enough = enough && (links == 0 || dem__grow_group(w, list, dem__link_arrays(w, list), &w->link_block__, &w->link_bytes__,
                                                      &w->link_capacity__, links));
    if (enough && passed > 0) {
        w->passed = (dem_passed *)memory.fn(memory.user, NULL, 0, (size_t)passed * sizeof *w->passed);
        enough = w->passed != NULL;
        w->passed_capacity__ = passed;
    }
    if (!enough) {
        dem_free(w);
        return DEM_OUT_OF_MEMORY;
    }
    w->count = (ptrdiff_t)present;
    w->keeps_out__ = 1;
    w->live_count__ = live;
    w->passed_count = passed;
    w->link_count__ = links;
    for (ptrdiff_t i = 0; i < w->count; i++) w->alive[i] = 1, w->wall_head__[i] = w->link_head__[i] = -1;
    dem__stream_state(&s, w, NULL, 1);
    dem__stream_passed(&s, w);
    const dem_status meshes = dem__stream_meshes(&s, w);
    check = s.hash;
    dem__u64(&s, &found);
    if (meshes == DEM_OUT_OF_MEMORY) {
        dem_free(w);
        return meshes;
    }
    if (meshes != DEM_OK || s.failed || found != check || s.at != size || !dem__loaded_is_sound(w)) {
        dem_free(w);
        return DEM_BAD_DATA;
    }
    w->dt__ = w->def.dt;
    w->has_periodic__ = w->def.periodic[0] | w->def.periodic[1] | w->def.periodic[2];
    w->stale__ = 1;
    dem__find_links(w);
    DEM__EACH(w, c) {
        dem__activate(w, w->live_i__[c]);
        if (w->live_j__[c] >= 0) dem__activate(w, w->live_j__[c]);
        else {
            w->live_wall_next__[c] = w->wall_head__[w->live_i__[c]];
            w->wall_head__[w->live_i__[c]] = (int32_t)c;
        }
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dem__weigh(w, i);
        if (dem__is_loaded(w, i) && !w->is_active__[i]) {
            dem__activate(w, i);
            w->touching[i]--;
            dem__divide(w, i);
        }
    }
    return DEM_OK;
}

/* ------------------------------------------------------------------------------------------- >>scalar laws */

/* Half the duration of a clipped contact times omega_0 (Schwager & Poeschel 2007): one form for any damping. */
DEM_INLINE double dem__half_duration(double zeta) {
    double d = zeta - 1.0;
    if (fabs(d) < 1e-3) return 1.0 - d * (1.0 / 3.0 - d * (2.0 / 15.0 - d * (2.0 / 35.0 - d * 8.0 / 315.0)));
    if (zeta < 1.0) return riddle_acos(zeta) / sqrt((1.0 - zeta) * (1.0 + zeta));
    double root = sqrt(zeta - 1.0) * sqrt(zeta + 1.0);
    return riddle_log(zeta + root) / root;
}

DEM_API double dem_restitution_of(double zeta, dem_restitution mode) {
    if (!(zeta >= 0.0 && zeta <= DBL_MAX)) return (double)NAN;
    if (mode == DEM_CLIPPED) return riddle_exp(-2.0 * zeta * dem__half_duration(zeta));
    return zeta < 1.0 ? riddle_exp(-RIDDLE_PI * zeta / sqrt((1.0 - zeta) * (1.0 + zeta))) : (double)NAN;
}

DEM_API double dem_damping_ratio(double e, dem_restitution mode) {
    if (!(e > 0.0 && e <= 1.0)) return (double)NAN;
    double log_e = riddle_log(e), zeta = -log_e / sqrt(RIDDLE_PI * RIDDLE_PI + log_e * log_e);
    if (mode == DEM_NAIVE || e == 1.0) return e == 1.0 ? 0.0 : zeta;
    if (e < 0.02) zeta = 1.0 / (2.0 * sqrt(e)); /* e -> 1/(4 zeta^2) */
    for (int k = 0; k < 60; k++) {
        double g = dem__half_duration(zeta), d = zeta - 1.0;
        double slope = fabs(d) < 1e-3 ? 2.0 / 3.0 - d * 4.0 / 15.0 * 0.5 : (g - zeta) / ((1.0 - zeta) * (1.0 + zeta));
        double next = zeta - (log_e + 2.0 * zeta * g) / (2.0 * slope);
        next = next > 0.0 ? next : 0.5 * zeta;
        double change = fabs(next - zeta);
        zeta = next;
        if (!(change > 2e-16 * zeta)) break;
    }
    return zeta;
}

DEM_API double dem_contact_time(double k, double mass, double zeta, dem_restitution mode) {
    if (!(k > 0.0 && mass > 0.0 && zeta >= 0.0) || !(zeta <= DBL_MAX) || (mode == DEM_NAIVE && !(zeta < 1.0))) return (double)NAN;
    double period = sqrt(mass / k);
    return mode == DEM_CLIPPED ? 2.0 * dem__half_duration(zeta) * period : RIDDLE_PI * period / sqrt((1.0 - zeta) * (1.0 + zeta));
}

DEM_API double dem_hertz_contact_time(double modulus, double radius, double mass, double speed) {
    if (!(modulus > 0.0 && radius > 0.0 && mass > 0.0 && speed > 0.0)) return (double)NAN;
    double k = 16.0 / 15.0 * modulus * sqrt(radius); /* energy 2/5 * 4/3 E* sqrt(R) delta^2.5 = m v^2/2 */
    double overlap = riddle_exp(0.4 * riddle_log(mass * speed * speed / k));
    return 2.943275175395 * overlap / speed; /* 2 sqrt(pi) Gamma(7/5)/Gamma(9/10) */
}

/* The pair (a, b) of radii and materials that is present and asks for the smallest step. */
DEM_API dem_advice dem_advise(const dem_world *world, int features, double speed) {
    dem_advice a = {HUGE_VAL, HUGE_VAL, HUGE_VAL, (double)NAN};
    double smallest[DEM_MATERIALS_MAX];
    const dem_world *w = world;
    if (!w || !w->def.allocator.fn || ((features & DEM_HERTZ) && !(speed > 0.0))) return a;
    for (int m = 0; m < DEM_MATERIALS_MAX; m++) smallest[m] = HUGE_VAL;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i] && w->particle[i].radius < smallest[w->material[i]]) smallest[w->material[i]] = w->particle[i].radius;
    }
    for (int m = 0; m < w->def.materials; m++) {
        if (!(smallest[m] < HUGE_VAL)) continue;
        const dem_material *mat = &w->def.material[m];
        double mass_m = 4.0 / 3.0 * RIDDLE_PI * smallest[m] * smallest[m] * smallest[m] * mat->density;
        double shear = 0.5 * mat->young_modulus / (1.0 + mat->poisson_ratio);
        double rayleigh = RIDDLE_PI * smallest[m] * sqrt(mat->density / shear) / (0.1631 * mat->poisson_ratio + 0.8766);
        a.rayleigh = rayleigh < a.rayleigh ? rayleigh : a.rayleigh;
        for (int q = 0; q < w->def.materials; q++) {
            int is_wall = 0;
            for (int k = 0; k < w->walls; k++) is_wall |= w->wall[k].material == q && w->wall[k].kind != DEM_EXIT;
            for (int side = 0; side < 2; side++) { /* 0: a sphere of material q, 1: a wall of it */
                if (side ? !is_wall : !(smallest[q] < HUGE_VAL)) continue;
                dem_birth b;
                double constants[DEM_CONSTANTS_MAX];
                double mass_q =
                    side ? HUGE_VAL : 4.0 / 3.0 * RIDDLE_PI * smallest[q] * smallest[q] * smallest[q] * w->def.material[q].density;
                memset(&b, 0, sizeof b);
                b.def = &w->def;
                b.features = features;
                b.pair = m < q ? &w->def.pair[m][q] : &w->def.pair[q][m];
                b.material_i = m, b.material_j = q;
                b.radius_i = smallest[m], b.radius_j = side ? 0.0 : smallest[q];
                b.mass = side ? mass_m : mass_m * mass_q / (mass_m + mass_q);
                double contact, damping;
                if (features & DEM_HERTZ) {
                    dem_prepare_hertz(&b, constants);
                    contact = dem_hertz_contact_time(0.75 * constants[DEM__HERTZ_K], constants[DEM__HERTZ_RADIUS], b.mass, speed);
                    double overlap = speed * contact / 2.943275175395;
                    damping = constants[DEM__HERTZ_GAMMA] * sqrt(sqrt(constants[DEM__HERTZ_RADIUS] * overlap));
                } else {
                    double zeta = dem_damping_ratio(b.pair->restitution, b.pair->mode);
                    contact = dem_contact_time(b.pair->stiffness, b.mass, zeta, b.pair->mode);
                    damping = 2.0 * zeta * sqrt(b.pair->stiffness * b.mass);
                }
                a.contact = contact < a.contact ? contact : a.contact;
                if (damping > 0.0 && b.mass / damping < a.dashpot) a.dashpot = b.mass / damping;
            }
        }
    }
    a.advised = a.contact / 20.0;
    if (0.5 * a.dashpot < a.advised) a.advised = 0.5 * a.dashpot;
    if ((features & DEM_HERTZ) && 0.2 * a.rayleigh < a.advised) a.advised = 0.2 * a.rayleigh;
    return a;
}

#endif /* DEM__BODIES */

#ifdef __cplusplus
}
#endif
#if defined(__clang__)
#pragma float_control(pop)
#elif defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__)
#pragma GCC pop_options
#endif
#endif /* DEM_H */
