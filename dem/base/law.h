/* What a law of contact gets and returns, and the kernels made from it: public types. */
#pragma once
#include "types.h"

/* Input of a law for one contact. i is a sphere, j a sphere or a wall; n points from j to i. */
typedef struct dem_contact {
    double gap;              /* S = distance - r_i - r_j [m]; negative: overlap */
    double closing;          /* -dS/dt [m/s]; positive: approaching */
    double slip[3];          /* velocity of i's surface relative to j's, tangential [m/s] */
    double translation[3];   /* the part of slip that comes from the centres' velocities [m/s] */
    double spin[3];          /* w_i - w_j [rad/s] */
    double normal[3];        /* n */
    double mass;             /* m_eff = m_i m_j/(m_i + m_j); wall: m_i [kg] */
    double dt;               /* time by which the history advances [s]; 0 when only the force is needed */
    double rate;             /* 1 / time step of the world [1/s] */
    double share;            /* 1 / number of contacts of the partner that has more [-] */
    const double *constants; /* as the law's prepare function set them */
    const void *user;        /* world->user */
} dem_contact;

/* Output of a law: forces on i. A law sets normal, contact and ended; with DEM_FRICTION tangential, and remaining if
   there is any; with DEM_ROLLING rolling; with DEM_ENERGY the rest. A law of links sets normal, tangential and ended.
   Members that a law does not set are 0. */
typedef struct dem_response {
    double normal;        /* along n; positive repels [N] */
    double contact;       /* the part of normal that stems from the overlap; 0 without overlap [N] */
    double tangential[3]; /* perpendicular to n [N]; acts at the point that divides the distance of the centres as the
                             radii do */
    double remaining[3];  /* the part of tangential that stays however small `contact` is: lubrication, adhesion [N];
                             default 0 */
    double rolling[3];    /* torque on i, the opposite on j [N m] */
    double elastic;       /* stored energy [J] */
    double normal_power;  /* dissipated by the normal dashpot [W] */
    double slide_loss;    /* dissipated by sliding in this step [J] */
    double rolling_power; /* dissipated by rolling and tangential dashpot [W] */
    double ended; /* 1: the contact has ended; its state may be dropped, and its forces end with this step. Otherwise 0
                     (a double, so that all vectors have one type) */
} dem_response;

/* Input of a law's prepare function for a contact that begins. */
typedef struct dem_birth {
    const dem_def *def;
    int features; /* features of the run */
    const dem_pair_def *pair;
    int material_i, material_j;
    double radius_i, radius_j; /* [m]; wall: radius_j = 0 and curvature below */
    double curvature;          /* of the wall at the point of contact [1/m]; 0 for a plane */
    double mass;               /* m_eff [kg] */
    double inertia;            /* I_i I_j/(I_i + I_j); wall: I_i [kg m2] */
    double damping_ratio;      /* of the pair's restitution and mode, DEM_LINEAR [-] */
    void *user;                /* world->user */
} dem_birth;

/* A law. It is a constant, so that the loop that DEM_KERNEL makes from it has no indirect call. */
typedef struct dem_law {
    /* Name and version identify the meaning of the states. Contacts and links go on, in a run and from a save, only
       under a law with the same name (up to a comma), the same version and the same number of states. "linear,
       friction" and "linear, with attraction" understand each other; "linear" and "Luding" do not
       (DEM_LAW_MISMATCH). Give a law whose states mean something else another name or version. NULL: only the number
       of states is compared. */
    const char *name;
    int version;
    int states;    /* doubles for each contact, 0 when it begins, <= DEM_STATE_MAX */
    int history;   /* the first of them, which force may change; the rest changes only by dem_set_contact_state() */
    int vectors;   /* the first 3 * vectors are tangential vectors, which the kernel turns with the contact */
    int constants; /* doubles that prepare sets, <= DEM_CONSTANTS_MAX */
    /* Sets the constants. Returns the k_n of a linear law with the pair's damping ratio [N/m], with which the
       restitution is accurate to third order; otherwise 0. */
    double (*prepare)(const dem_birth *birth, double *constants);
    void (*force)(const dem_contact *contact, double *state,
                  dem_response *response); /* always inline, no calls, few branches */
    /* Both may be NULL; they get world->user. born: for the contacts that begin in a step, before their first force,
       sorted by partners. ended: for a contact that has ended, by itself, or because a particle was removed (its
       world->alive is not DEM_PRESENT) or a wall no longer acts (dem_wall_acts). dem_get_contact() (for a link
       dem_get_link()) and dem_set_contact_state() take their numbers. */
    void (*born)(struct dem_world *world, const int32_t *numbers, ptrdiff_t n, void *user);
    void (*ended)(struct dem_world *world, int32_t number, void *user);
} dem_law;

typedef void (*dem_loop_fn)(struct dem_world *world, ptrdiff_t first, ptrdiff_t end,
                            int part); /* made by the two macros below */

/* A law of contacts with the loop that evaluates it for some features. DEM_KERNEL(name, law, features), outside of
   functions, makes one: a constant. features: DEM_FRICTION and DEM_ROLLING if the law computes them, DEM_ENERGY for the
   ledger. */
typedef struct dem_kernel {
    const dem_law *law;
    int features;
    dem_loop_fn loop;
    void (*add_ledger)(struct dem_world *world); /* NULL without DEM_ENERGY */
} dem_kernel;

/* The same for a law of links: DEM_LINK_KERNEL(name, law). */
typedef struct dem_link_kernel {
    const dem_law *law;
    dem_loop_fn loop;
} dem_link_kernel;
