/* The private state behind a world, in structs. Their comments say where most of the work is done, not every place that
   writes a field: ask grep. */
#pragma once
#include "feature.h"
#include "polyhedra_state.h"

/* Bound on a particle's motion, in the frame in free fall since the list was built. At t [s] after that, the particle's
   surface lies within reach + t tolerance of the point x + t u. The bound holds while the velocity differs from u by
   less than the tolerance; then the particle gets a new bound. One cache line. */
typedef struct dem__bound {
    double x, y, z, reach;        /* [m] */
    double ux, uy, uz, tolerance; /* [m/s] */
} dem__bound;

typedef double dem__two_vec[6];   /* two vectors, which dem__first and dem__second return */
typedef dem__two_vec dem__wrench; /* force [N] and torque [N m] */

/* Sums of forces and torques on a particle, and the factors that turn them into accelerations. One cache line. */
typedef struct dem__sum {
    dem__wrench load;
    double per_mass, per_inertia; /* [1/kg], [1/(kg m2)] */
} dem__sum;

/* Constants that contacts of the same sizes and materials share. */
typedef struct dem__contact_type {
    double mass, predict; /* m_eff [kg]; factor of the closing speed in contact [-] */
    double sum, part;     /* r_i + r_j [m]; r_i / (r_i + r_j) [-]; at a wall 1 */
    double constant[DEM_CONSTANTS_MAX];
} dem__contact_type;

/* A chunk holds the contacts whose lower rank (see dem__lower_rank) is at least first_rank and below that of the chunk
   before, in the slots first .. first + count - 1. When it is full, new contacts go to the last chunk, which can grow.
   So a particle has contacts only in its own chunk and in later ones. */
typedef struct dem__chunk {
    ptrdiff_t first, count, capacity;
    ptrdiff_t marked, postponed; /* contacts that begin or end in this step, listed in contacts.slots; number of
                                    postponed forces */
    int32_t first_rank;
    int at_walls; /* whether a contact with a wall was evaluated in this step */
} dem__chunk;

/* A force that this thread may not add yet, because another thread must add to that particle first. It is in the lists
   of the shares to which i and j belong. */
typedef struct dem__postponed {
    double out[9];
    int32_t i, j, next_i, next_j; /* next_: entry * 2 + (0: its i, 1: its j), or -1 */
} dem__postponed;

/* Correction of a partial step of a contact, applied at the end of the step. */
typedef struct dem__correction {
    double n[3], shift; /* normal; mass times the distance by which it moves the bodies apart along it [kg m] */
    double impulse[9];  /* time integrals of the force on i and the torques on i and j [N s], [N m s] */
} dem__correction;

/* Force [N] and torque [N m] of a chunk's contacts on a wall, and the power of its belt [W]. */
typedef struct dem__wall_force {
    dem_vec force, torque;
    double belt_power;
} dem__wall_force;

/* What contacts keep about the place where they touch: the arrays of contacts.touch. A sphere at a mesh, a sphere at a
   cone and a polyhedron each use them in their own way; other contacts have none. */
enum {
    DEM__PLACE_NORMAL = 0,    /* mesh, polyhedron: normal of the place that it follows (3 numbers) */
    DEM__PLACE_GAP = 3,       /* mesh, polyhedron: gap there [m] */
    DEM__PLACE_BEFORE = 11,   /* mesh, polyhedron: the normal one step before (3) */
    DEM__PLACE_CACHE = 4,     /* mesh: dem__face_cache.at (3) */
    DEM__PLACE_SLACK = 7,     /* mesh: dem__face_cache.slack [m]; 0: no face */
    DEM__PLACE_FACE = 8,      /* mesh: dem__face_cache.face */
    DEM__PLACE_ARM = 4,       /* polyhedron: from the centre of i to that of the sphere that touches [m] (3) */
    DEM__PLACE_WEIGHT = 7,    /* polyhedron: factor of the force [-] */
    DEM__PLACE_CURVATURE = 8, /* polyhedron: curvature of the wall as the contact began [1/m] */
    DEM__PLACE_DAMPING = 9,   /* polyhedron: factor of the closing speed [-] */
    DEM__PLACE_PULL = 10,     /* polyhedron: its part of the pair's pull over the spring [1/m; Hertz 1/m1.5] */
    DEM__PLACE_WAS = 14,      /* polyhedron: factor of the force one step before; then the energy of friction that its
                                 change takes [J] */
    DEM__KEPT_CURVATURE = 0,  /* sphere at a cone: curvature of the wall as the contact began [1/m] */
    DEM__PLACES = 15
};

/* Two particles that may touch before the list is rebuilt. */
typedef struct dem__near {
    int32_t i, j;    /* the particle with the lower id first */
    double distance; /* distance of the centres below which they touch [m] */
} dem__near;

/* A rigid body with an orientation. Its state, like that of a sphere, is the one at the origin step of its first
   particle. Its moments are about its principal axes; the first two are equal if any two are. Its particles, which
   touch others, are consecutive. */
typedef struct dem__rigid {
    dem_vec x, v, a;          /* centre of mass [m], [m/s], [m/s2] */
    dem_vec momentum, torque; /* angular momentum [kg m2/s] and torque [N m] about it */
    dem_quaternion turn;      /* orientation of its principal axes */
    dem_quaternion frame;     /* from its principal axes to the frame in which its shape is given */
    dem_vec moments;          /* [kg m2] */
    double mass;              /* [kg] */
    double rate;              /* of the contacts of a clump over k/m; not saved */
    int32_t first, pieces;    /* of its particles */
    /* How many rotation steps of a flight, with three different moments, have been integrated, and the orientation
       there. -1: that at the end of the present step. Neither is saved. */
    double rotation_steps;
    dem_quaternion ahead;
} dem__rigid;

/* State of a rigid body at a time: position and velocity of its centre of mass, spin, angular momentum, orientation. */
typedef struct dem__pose {
    dem_vec x, v, spin, momentum;
    dem_quaternion turn;
} dem__pose;

/* The functions that the engine calls for rigid bodies, in the order of a step; they are in bodies/rigid.h. The first
   body of a world sets the table (dem__reserve_bodies), so that a program that neither adds a body nor loads a world
   compiles none of them. */
typedef struct dem__body_calls {
    /* return the state, and the orientation alone, at tau [s] after the origin step */
    dem__pose (*pose)(const dem_world *w, const dem__rigid *r, double tau);
    dem_quaternion (*turn)(const dem_world *w, const dem__rigid *r, double tau);
    void (*set_origin)(dem_world *w, dem__rigid *r); /* makes the present step the origin */
    void (*set_motion)(dem_world *w, dem__rigid *r, dem_vec velocity,
                       dem_vec spin);           /* sets velocity and spin at the origin */
    void (*place)(dem_world *w, dem__rigid *r); /* places its particles from its state */
    void (*fall)(dem_world *w, dem__rigid *r);  /* computes accelerations without contacts */
    void (*test_due)(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part,
                     void *step); /* tests due pairs, in pages of timers */
    void (*advance)(dem_world *w, ptrdiff_t first, ptrdiff_t end, int part, void *h); /* moves active particles and
                                                                                         bodies to the end of a step */
    void (*push)(dem_world *w, int32_t c, int has_friction); /* applies impulses of the partial step in slot c */
    /* greatest speed in flight of a point at an arm [m] from the centre, relative to it [m/s] */
    double (*turning_speed)(const dem__rigid *r, double arm);
} dem__body_calls;

/* The steps in which near pairs, or particles and walls, are tested next. */
typedef struct dem__timers {
    int64_t from;              /* step from which `due` counts */
    int32_t *due;              /* step after `from`, or DEM__NEVER, or DEM__STOPPED */
    int32_t *earliest;         /* for each line: no timer of it is due before */
    int32_t *list;             /* timers found due */
    ptrdiff_t pages, capacity; /* in use; room, in lines */
    void *block;
    size_t bytes;
} dem__timers;
/* NEVER: not on the present bounds; STOPPED: while the pair touches, or after a particle has left. */
enum { DEM__NEVER = INT32_MAX - 1, DEM__STOPPED = INT32_MAX };

/* Activity of a particle: in free flight; taking steps; taking steps, and its bound is checked at the end of this
   one. */
enum { DEM__FLYING, DEM__STEPPING, DEM__TO_CHECK };

/* The run: time, law and pending work. step/step.h sets it for a run; whatever changes a world sets needs_*. */
typedef struct dem__run {
    double dt, kernel_dt; /* [s]; kernel_dt is 0 where forces are computed but no time passes */
    double start_time;    /* time of start_step [s] */
    int64_t start_step;
    const dem_law *law;
    int features;
    int has_periodic;
    int needs_forces; /* forces must be computed before the first step */
    int needs_lists;  /* near pairs and timers must be rebuilt */
    int leaving;      /* a particle passed an exit in this step */
    int running;      /* a run or a removal is in progress: functions of the caller may not change the world */
    int ending;       /* the law's hook ended is running: it may not even add links */
    int keeps_wrenches;
    int has_friction;
    double power;    /* power of the overlap to which the elastic energy of a contact is proportional: 2, Hertz 2.5 */
    int turns;       /* whether spins may change in this step: without friction and loads only those of rigid bodies
                        do */
    double stiffest; /* greatest k dt^2/m_eff of the contacts for which the law has computed constants */
    int has_unset_pairs; /* some pair of different materials was never set */
    int only_ledger;     /* the kernel only computes what contacts store and dissipate; nothing else changes */
    double damping_ratio[DEM_MATERIALS_MAX][DEM_MATERIALS_MAX];
} dem__run;

/* State of a fixed particle: the force of contacts and links on it in the last step, and the time integral of the force
   since it was fixed. */
typedef struct dem__fixed {
    dem__wrench load;
    dem_vec impulse; /* [N s] */
    int64_t on;      /* 0: not fixed */
} dem__fixed;

/* Particles, beside the public arrays of the world. particles/particles.h adds them, step/integrate.h, bodies/rigid.h
   and gas/flights.h move them, search/bounds.h bounds their motion, particles/active.h closes gaps. */
typedef struct dem__bodies {
    ptrdiff_t capacity, dropped; /* dropped: left or removed, but still in the arrays */
    uint64_t next_id;
    int adds_loads; /* in a run: loads are added to the forces of contacts */
    int loads_on;   /* a particle has had an external load, or has been fixed */
    int has_fixed;  /* a particle has been fixed since the world was made */
    void *block;
    size_t bytes;
    dem__sum *sum;
    dem__wrench *load;     /* constant within a step: external loads and links */
    dem__wrench *external; /* the external part */
    dem__bound *bound;
    dem_vec *impact;         /* change of velocity from the beginning to the middle of an impact [m/s] */
    double *shifted;         /* distance by which partial steps have shifted it from its bound [m] */
    double *wall_speed;      /* speed that its wall timers rely on [m/s] */
    double *mass_share;      /* 1 / contacts [-] */
    int32_t *activity;       /* DEM__FLYING .. */
    int32_t *number;         /* number of present particles before it: its index without gaps */
    int32_t *rank, *by_rank; /* its rank, which orders contacts; the particle of a rank. Removed particles keep a rank
                                until arrays are rebuilt without them */
    int by_place;               /* in a run: particles lie in the order of ranks, */
    int32_t *given;             /* and this is the index that the caller knows */
    int32_t *active, *to_check; /* lists: particles that take steps; those with DEM__TO_CHECK */
    int32_t *active_at;         /* position in the first list */
    ptrdiff_t active_count, to_check_count;
    ptrdiff_t passed_capacity;
    dem__rigid *rigid;            /* bodies with an orientation; NULL if there are none */
    const dem__body_calls *calls; /* set with them */
    ptrdiff_t rigid_count, rigid_capacity;
    int32_t *rigid_of;     /* for a particle: index of its body + 1; 0: a single sphere; NULL if there are no bodies */
    dem__fixed *fixed;     /* NULL unless has_fixed */
    dem_vec *offset, *arm; /* from the body's centre to the particle's [m]: along the principal axes; in the world's
                              axes, at the origin */
} dem__bodies;

/* Walls, beside the public array. The file of its kind adds one, walls/kinematics.h moves it, search/narrow_phase.h and
   search/bounds.h set its timers. */
typedef struct dem__wall_state {
    ptrdiff_t capacity;
    int touch_keepers,
        controls;           /* number of walls whose contacts keep a touch (meshes, cones); whether forces drive any
                               wall */
    dem__timers timers;     /* for particle i and wall k: index i * walls + k */
    uint32_t *sure;         /* step, modulo 2^32, before which no test is needed, whatever the particle's bound */
    int32_t *first_contact; /* for a particle: its first contact with a wall; contacts.wall_next leads on */
} dem__wall_state;

/* Near pairs and the list's life. search/skin.h chooses how long the list may last, search/neighbour_list.h builds it,
   step/detect.h tests the pairs. */
typedef struct dem__pairs {
    ptrdiff_t count, due_count; /* due_count: tested in the last step */
    dem__near *near;
    dem__timers timers;
    int32_t *adjacent_start, *adjacent; /* (pair, other particle) for each near pair of a particle */
    int32_t *cells, *cell_of;
    ptrdiff_t adjacent_capacity, cells_capacity;
    dem_vec *listed_at;              /* position when the list was built */
    int64_t listed_step, next_check; /* when the list was built; when it must be checked next */
    double steps_per_second;
    double skin, skin_factor;                   /* gap up to which pairs are listed [m]; factor of the skin, 1 .. 3 */
    double least_tolerance;                     /* of bounds [m/s] */
    double touch_gap;                           /* gap below which a contact may begin [m]: 0, but for linked pairs */
    double wall_reach;                          /* gap up to which walls are searched for [m] */
    double position_tolerance;                  /* how far corrections may shift a particle from its bound [m] */
    double gravity_size;                        /* [m/s2] */
    dem_vec frame_velocity, frame_acceleration; /* frame in which the list measures how far particles have moved */
    double frame_fall; /* greatest acceleration in that frame of particles without contacts [m/s2] */
} dem__pairs;

/* Contacts, in slots of chunks. In each chunk those that begin in a step follow those of earlier steps, ordered by
   partners; gaps are filled from its end; now and then all are sorted by rank, the last first. The order of slots
   depends only on the history of the scene, never on threads. It fixes the order of every sum, and so the bits.
   search/narrow_phase.h and polyhedra/pairs.h begin them, contacts/kernel.h and contacts/first_and_last_step.h evaluate
   them, contacts/contacts.h orders and ends them. */
typedef struct dem__contacts {
    ptrdiff_t count, capacity, begun; /* begun: in this step, at the end of the last chunk */
    int chunk_count;
    dem__chunk chunk[DEM__CHUNKS];
    int shares;                      /* among which threads divide the chunks in this step */
    int32_t share_from[DEM__CHUNKS]; /* least rank of each share's own particles */
    dem__wall_force *wall_force;     /* [chunk][wall], walls.capacity apart */
    int force_chunks;                /* for so many chunks */
    dem__postponed *postponed;       /* with threads */
    int states, constants;           /* number of arrays of each */
    int has_history;                 /* whether states can differ from zero */
    uint64_t law;                    /* dem__law_mark of the law that made them; 0: unknown */
    void *block;
    size_t bytes;
    int32_t *i, *j, *element, *near, *wall_next; /* j < 0: wall -1 - j; near: the near pair; -1: none; below -1: a
                                                    contact of a polyhedron (dem__is_convex_contact) */
    int32_t *type;                               /* index in types; -1: constants of its own */
    int32_t *slots;                              /* a list of slots, or one in each chunk */
    uint8_t *partial; /* its partial step is to be corrected: the kernel writes it for the contacts that it lists;
                         before that dem__follow_meshes marks meshes with places left in it */
    uint8_t *ended; /* has ended */
    double *gap, *force;
    double *state[DEM_STATE_MAX];
    double
        *touch[DEM__PLACES]; /* data of the place where it touches: see DEM__PLACE_NORMAL; only with
                                walls.touch_keepers */
    double *wrench[9];       /* force on i, torques on i and j, from a run's last step */
    dem__correction *correction; /* from the kernel to the end of the step; before that, scratch memory of
                                    dem__arrange */
    double *elastic, *power[3],
        *loss[4]; /* with a ledger: power by normal, rolling, wall; loss by normal, sliding, rolling, wall */
    dem__contact_type types[DEM__TYPES_MAX];
    int type_count;
    double *mass, *predict, *sum, *part, *constant[DEM_CONSTANTS_MAX]; /* of contacts with constants of their own */
} dem__contacts;

/* Links, in the order in which they were made; each is in the lists of its two bodies. links/links.h adds and steps
   them, contacts/kernel.h evaluates them, removal/remove.h cuts them. */
typedef struct dem__links {
    const dem_law *law;
    dem_loop_fn loop;
    double interval, near;
    int on, every, states; /* every: steps between two evaluations */
    uint64_t mark;         /* dem__law_mark of the law that made the states; 0: unknown */
    ptrdiff_t count, capacity;
    void *block;
    size_t bytes;
    int32_t *i, *j, *element, *next_i, *next_j;
    double *state[DEM_STATE_MAX], *wrench[9], *gap;
    uint8_t *ended;
    int32_t *first_link,
        *is_loaded; /* for a particle: the first link of its list; whether its load contains forces of links */
    dem__two_vec *evaluated_at; /* for a particle: position [m] and spin [rad/s] at the last evaluation of links */
    int64_t evaluated_step;     /* step of that evaluation */
} dem__links;

struct dem__view;

/* A force field, and the flights in it. gas/flights.h begins and ends flights, gas/field.h computes them. */
typedef struct dem__field {
    int on; /* a field is set; after loading its law may be missing */
    dem_force_field def;
    dem__timers timers;    /* of flights: the step in which the next flight begins */
    int64_t rebuilds;      /* number of lists built when the timers were made */
    int32_t *stepping;     /* particles that took the last step */
    ptrdiff_t steppers;    /* their number */
    int64_t *until;        /* step in which a particle's flight ends, or DEM__NO_FLIGHT */
    dem_vec *end_velocity; /* velocity there [m/s] */
    dem_vec *force;        /* on a particle that takes steps, in its last one [N] */
    dem_vec *torque;       /* the same [N m] */
    double *work;          /* work of the field along the flight [J] */
    double *booked;        /* part of this work that is in the ledger [J] */
    struct dem__view *view; /* shapes of bodies as a flow sees them, made at the beginning of a run (gas/view.h) */
    ptrdiff_t views, view_capacity;
    int32_t *view_of; /* of a body's first particle: 1 + index of its view; 0: none yet; -1: it is one sphere */
} dem__field;
#define DEM__NO_FLIGHT INT64_MAX

/* The energy ledger. step/step.h begins, pauses and resumes it; energy/postings.h books. */
typedef struct dem__ledger {
    int on, started;      /* whether its arrays exist; whether a run with DEM_ENERGY has begun */
    int counts;           /* whether the last run had DEM_ENERGY */
    double stored_before; /* in contacts, before forces are computed again [J] */
    double paused_error;  /* error of the balance when a run without DEM_ENERGY began [J] */
    dem_energy_ledger sums;
} dem__ledger;

/* Scratch memory. */
typedef struct dem__work dem__work;
typedef struct dem__scratch {
    char *work; /* of each thread, in a run: see dem__work_of */
    int works;
    int threads; /* that a run uses: def.threads, or fewer if there are fewer processors and the threads are not the
                    host's */
    void *work_block;
    size_t work_bytes;
    int32_t *index; /* one entry for each particle; no value outlives the function that fills it and those that it
                       calls */
} dem__scratch;

/* Whether OpenMP's threads save time. base/parallel.h alone writes it; no result depends on it. */
typedef struct dem__pace {
    double loss;              /* time lost by waiting and not yet made up for [s] */
    double alone_until, rest; /* time until which loops run on one thread; duration of the last such period [s] */
} dem__pace;

typedef struct dem__engine {
    dem__feature feature[DEM__FEATURES_MAX]; /* those of the world, in the order of `place` */
    int features;
    dem__run run;
    dem__bodies bodies;
    dem__wall_state walls;
    dem__pairs pairs;
    dem__contacts contacts;
    dem__links links;
    dem__ledger ledger;
    dem__convex_state convex;
    dem__scratch scratch;
    dem__pace pace;
    dem__field field;
} dem__engine;

/* Loops over every contact: DEM__EACH_CONTACT(w, c) { .. slot c .. }; break leaves only a chunk. */
#define DEM__EACH_CONTACT(w, c)                                                                                        \
    for (const dem__chunk *in_##c = (w)->engine->contacts.chunk;                                                       \
         in_##c < (w)->engine->contacts.chunk + (w)->engine->contacts.chunk_count; in_##c++)                           \
        for (ptrdiff_t c = in_##c->first; c < in_##c->first + in_##c->count; c++)

/* Calls a member of every feature that has it: DEM__TELL(w, add_particle, (w, i)). */
#define DEM__TELL(w, member, arguments)                                                                                \
    do {                                                                                                               \
        for (int f_ = 0; f_ < (w)->engine->features; f_++) {                                                           \
            if ((w)->engine->feature[f_].member) (w)->engine->feature[f_].member arguments;                            \
        }                                                                                                              \
    } while (0)
/* The same for a member that returns 0 after a failure; after one nothing more is called. ok: an int, 1 at first. */
#define DEM__ASK(w, ok, member, arguments)                                                                             \
    do {                                                                                                               \
        for (int f_ = 0; f_ < (w)->engine->features && (ok); f_++) {                                                   \
            if ((w)->engine->feature[f_].member) (ok) = (w)->engine->feature[f_].member arguments;                     \
        }                                                                                                              \
    } while (0)
/* The same for a member whose result, the last one, is wanted. */
#define DEM__GET(w, result, member, arguments)                                                                         \
    do {                                                                                                               \
        for (int f_ = 0; f_ < (w)->engine->features; f_++) {                                                           \
            if ((w)->engine->feature[f_].member) (result) = (w)->engine->feature[f_].member arguments;                 \
        }                                                                                                              \
    } while (0)
/* The same for a member that returns a number, which is added to a sum. */
#define DEM__ADD_UP(w, sum, member, arguments)                                                                         \
    do {                                                                                                               \
        for (int f_ = 0; f_ < (w)->engine->features; f_++) {                                                           \
            if ((w)->engine->feature[f_].member) (sum) += (w)->engine->feature[f_].member arguments;                   \
        }                                                                                                              \
    } while (0)
/* The same for a member that returns a status; after the first that is not DEM_OK nothing more is called. */
#define DEM__CHECK(w, status, member, arguments)                                                                       \
    do {                                                                                                               \
        for (int f_ = 0; f_ < (w)->engine->features && (status) == DEM_OK; f_++) {                                     \
            if ((w)->engine->feature[f_].member) (status) = (w)->engine->feature[f_].member arguments;                 \
        }                                                                                                              \
    } while (0)

/* Adds a feature to a world unless it has it. */
static inline void dem__add_feature(dem_world *w, dem__feature feature) {
    dem__engine *e = w->engine;
    int k = e->features;
    for (int q = 0; q < e->features; q++) {
        if (e->feature[q].place == feature.place) return;
    }
    for (e->features++; k > 0 && e->feature[k - 1].place > feature.place; k--) e->feature[k] = e->feature[k - 1];
    e->feature[k] = feature;
}
static inline void dem__drop_feature(dem_world *w, int place) {
    dem__engine *e = w->engine;
    int left = 0;
    for (int q = 0; q < e->features; q++) {
        if (e->feature[q].place != place) e->feature[left++] = e->feature[q];
    }
    e->features = left;
}
