/* -------------------------------------------------------------------------------------------- >>engine */
/* The private state behind a world, in owners; each names the files that write it.
   Relies on types.h.
   May be changed here alone: a field that only its owner's files name; saved fields are rows of saved.h, arrays rows of store.h. */

/* Bound on a particle's motion, in the frame in free fall since the list was built, t [s] ago: its surface lies within reach + t tolerance
   of the point x + t u, while its velocity differs from u by less than the tolerance. Then it gets a new bound. One cache line. */
typedef struct dem__bound {
    double x, y, z, reach;        /* [m] */
    double ux, uy, uz, tolerance; /* [m/s] */
} dem__bound;

typedef double dem__wrench[6]; /* force [N] and torque [N m], or position [m] and spin [rad/s] */

/* Sums of forces and torques on a particle, and what turns them into accelerations. One cache line. */
typedef struct dem__sum {
    dem__wrench load;
    double per_mass, per_inertia; /* [1/kg], [1/(kg m2)] */
} dem__sum;

/* Constants that contacts of the same sizes and materials share. */
typedef struct dem__contact_type {
    double mass, predict; /* m_eff [kg]; factor of the closing speed in contact [-] */
    double sum, part;     /* r_i + r_j [m]; r_i / (r_i + r_j) [-], of a wall 1 */
    double constant[DEM_CONSTANTS_MAX];
} dem__contact_type;

/* A chunk holds the contacts whose first particle is at least first_particle and below that of the chunk before, in the slots first ..
   first + count - 1. When it is full, new contacts go to the last chunk, which can grow. As i < j, a particle has contacts in its own
   chunk and in later ones only. */
typedef struct dem__chunk {
    ptrdiff_t first, count, capacity;
    ptrdiff_t marked, postponed;           /* contacts that begin or end in a step, listed in slots; forces that another thread adds */
    int32_t first_particle, postpone_from; /* forces on particles from postpone_from on are postponed: see dem__next_chunk */
    int32_t low, high;                     /* least and greatest particle with a postponed force; without one INT32_MAX, 0 */
} dem__chunk;

/* A force that this thread may not add yet, because another thread must add to that particle first. */
typedef struct dem__postponed {
    double out[9];
    int32_t i, j;
} dem__postponed;

/* Impulses of a contact that begins or ends in a step, applied at the end of the step. */
typedef struct dem__correction {
    double n[3], shift; /* normal; mass times the distance by which it moves its bodies apart along it [kg m] */
    double impulse[9];  /* force on i, torques on i and j, over time [N s], [N m s] */
} dem__correction;

/* Force [N] and torque [N m] of a chunk's contacts on a wall. */
typedef struct dem__wall_force {
    dem_vec force, torque;
} dem__wall_force;

enum { DEM__PLACES = 12 }; /* numbers that a contact with a mesh keeps of its place */

/* Two particles that may touch before the list is built anew. */
typedef struct dem__near {
    int32_t i, j;    /* i < j */
    double distance; /* of centres, below which they are in contact [m] */
} dem__near;

/* A rigid body that has an orientation: its state at the origin step of its first particle, as that of a sphere is; moments about its
   principal axes, of which the first two are equal if any two are. Its particles, which touch for it, lie one after the other. */
typedef struct dem__rigid {
    dem_vec x, v, a;          /* centre of mass [m], [m/s], [m/s2] */
    dem_vec momentum, torque; /* angular momentum [kg m2/s] and torque [N m] about it */
    dem_quaternion turn;      /* of its principal axes */
    dem_quaternion frame;     /* from its principal axes to the frame in which its shape is given */
    dem_vec moments;          /* [kg m2] */
    double mass;              /* [kg] */
    int32_t first, pieces;    /* of its particles */
    double strides;           /* of a flight with three moments: so many quarter radians of it are known, */
    dem_quaternion ahead;     /* and lead here; neither is saved */
} dem__rigid;

/* The steps in which near pairs, or particles and walls, are tested next. */
typedef struct dem__timers {
    int64_t from;              /* the step that others are counted from */
    int32_t *due;              /* step, or DEM__NEVER, or DEM__STOPPED */
    int32_t *earliest;         /* of each line: none of its timers is due before */
    int32_t *list;             /* those found due */
    ptrdiff_t pages, capacity; /* in use; room, in lines */
    void *block;
    size_t bytes;
} dem__timers;
enum { DEM__NEVER = INT32_MAX - 1, DEM__STOPPED = INT32_MAX }; /* with the present bounds; as long as it touches, or has left */

/* Activity of a particle: in free flight; taking steps; taking steps, its bound to be checked at the end of this one. */
enum { DEM__FLYING, DEM__STEPPING, DEM__TO_CHECK };

/* The run: time, the law and what has changed since the last step. Written by step.h; needs_* by whatever changes a world. */
typedef struct dem__run {
    double dt, kernel_dt; /* [s]; the kernel's: 0 where forces are found but no time passes */
    double start_time;    /* time of start_step [s] */
    int64_t start_step;
    const dem_law *law;
    int features;
    int has_periodic;
    int needs_forces; /* forces must be found before the first step */
    int needs_lists;  /* near pairs and timers must be made anew */
    int leaving;      /* a particle passed an exit in this step */
    int running;      /* a run has begun: hooks of laws are refused what changes the world */
    int keeps_wrenches;
    int has_unset_pairs; /* of two materials that differ, in this run */
    int only_ledger;     /* the kernel only finds what contacts store and dissipate now; nothing else changes */
    double damping_ratio[DEM_MATERIALS_MAX][DEM_MATERIALS_MAX];
} dem__run;

/* Particles, beside the public arrays of the world. Written by body.h, bounds.h, step.h. */
typedef struct dem__bodies {
    ptrdiff_t capacity, dropped; /* dropped: gone, but still in the arrays */
    uint64_t next_id;
    int loads_on;
    void *block;
    size_t bytes;
    dem__sum *sum;
    dem__wrench *load;     /* constant within a step: external and of links */
    dem__wrench *external; /* its external part */
    dem__bound *bound;
    dem_vec *impact;            /* what a contact that has just begun adds to its velocity by the middle of the impact [m/s] */
    double *shifted;            /* how far first and last steps of contacts have shifted it from its bound [m] */
    double *wall_speed;         /* speed that its wall timers count on [m/s] */
    double *mass_share;         /* 1 / contacts [-] */
    int32_t *activity;          /* DEM__FLYING .. */
    int32_t *number;            /* how many of those present come before it: its number without gaps */
    int32_t *active, *to_check; /* lists: those that take steps; those with DEM__TO_CHECK */
    ptrdiff_t active_count, to_check_count;
    ptrdiff_t passed_capacity;
    dem__rigid *rigid; /* bodies with an orientation; NULL without any */
    ptrdiff_t rigid_count, rigid_capacity;
    int32_t *rigid_of;     /* of a particle: its body's number + 1, or 0 for a sphere that is its own; NULL without any such body */
    dem_vec *offset, *arm; /* from the body's centre to the particle's, along the principal axes; in the lab, at the origin [m] */
} dem__bodies;

/* Walls, beside the public array. Written by walls.h, motion.h, detect.h. */
typedef struct dem__wall_state {
    ptrdiff_t capacity;
    int meshes, touch_keepers, controls; /* number of meshes; of meshes and cones, whose contacts keep a touch; any driven by forces? */
    dem__timers timers;                  /* of particle i and wall k: i * walls + k */
    uint32_t *sure;                      /* step, modulo 2^32, before which no test is needed, whatever the particle's bound */
    int32_t *first_contact;              /* of a particle with a wall, then contacts.wall_next */
} dem__wall_state;

/* Near pairs and the list's life. Written by pairs.h, bounds.h. */
typedef struct dem__pairs {
    ptrdiff_t count, due_count; /* due_count: tested in the last step */
    dem__near *near;
    dem__timers timers;
    int32_t *adjacent_start, *adjacent; /* (pair, other particle) of each particle */
    int32_t *cells, *cell_of;
    ptrdiff_t adjacent_capacity, cells_capacity;
    dem_vec *listed_at;              /* position when the list was built */
    int64_t listed_step, next_check; /* when the list was built; when it must be checked */
    double steps_per_second;
    double margin, margin_factor;               /* gap up to which pairs are listed [m]; its stretch, 1 .. 3 */
    double least_tolerance;                     /* of bounds [m/s] */
    double wall_reach;                          /* how far walls are looked for [m] */
    double position_tolerance;                  /* how far corrections may shift a particle from its bound [m] */
    double gravity_size;                        /* [m/s2] */
    dem_vec frame_velocity, frame_acceleration; /* frame in which the list checks how far particles have moved */
    double frame_fall;                          /* acceleration of particles in that frame at most, without contacts [m/s2] */
} dem__pairs;

/* Contacts, in slots of chunks: in each chunk those of a step by partners, after those of earlier steps; gaps are filled from its end; now
   and then all are ordered by i, the last first. The order of slots depends only on the history of the scene, never on threads; it fixes
   the order of every sum, and so the bits. Written by contacts.h, kernel.h, edges.h. */
typedef struct dem__contacts {
    ptrdiff_t count, capacity, begun; /* begun: in this step, at the end of the last chunk */
    int chunk_count;
    dem__chunk chunk[DEM__CHUNKS];
    dem__wall_force *wall_force; /* [chunk][wall], walls.capacity apart */
    dem__postponed *postponed;   /* with threads */
    int states, constants;       /* arrays that there are of each */
    int has_history;             /* can the states be other than zero? */
    void *block;
    size_t bytes;
    int32_t *i, *j, *element, *near, *wall_next; /* j < 0: wall -1 - j; near: the pair, or -1 */
    int32_t *type;                               /* index in types, or -1: has constants of its own */
    int32_t *slots;                              /* a list of slots, or one in each chunk */
    uint8_t *edge, *ended;                       /* begins or ends in this step; is over */
    double *gap, *force;
    double *state[DEM_STATE_MAX];
    double *touch[DEM__PLACES]; /* with a mesh: normal and gap of the place that it follows, then its footing: place, slack, face, and
                                   the normal before; with a cone: its curvature */
    double *wrench[9];          /* force on i, torques on i and j: of a run's last step */
    dem__correction *correction;
    double *elastic, *power[3], *loss[4]; /* with a ledger: normal, rolling, wall; normal, sliding, rolling, wall */
    dem__contact_type types[DEM__TYPES_MAX];
    int type_count;
    double *mass, *predict, *sum, *part, *constant[DEM_CONSTANTS_MAX]; /* of those with constants of their own */
} dem__contacts;

/* Links, in the order of their making; each stands in the lists of its bodies. Written by contacts.h, kernel.h, step.h. */
typedef struct dem__links {
    const dem_law *law;
    dem_loop_fn loop;
    double interval, near;
    int on, stride, states;
    ptrdiff_t count, capacity;
    void *block;
    size_t bytes;
    int32_t *i, *j, *element, *next_i, *next_j;
    double *state[DEM_STATE_MAX], *wrench[9], *gap;
    uint8_t *ended;
    int32_t *first_link, *is_loaded; /* of a particle: the head of its list; does its load have a part of links? */
    dem__wrench *evaluated_at;       /* of a particle: position and spin when links were evaluated last */
} dem__links;

/* A force field, and the flights in it. Written by field.h. */
typedef struct dem__field {
    int on; /* a field was set; after loading without its law */
    dem_force_field def;
    dem__timers timers;    /* of flights: the step in which the next one begins */
    int64_t rebuilds;      /* of the list that the timers were made for */
    int32_t *stepping;     /* those that took the last step, */
    ptrdiff_t steppers;    /* so many */
    int64_t *until;        /* step at which a particle's flight ends, or DEM__NO_FLIGHT */
    dem_vec *end_velocity; /* there [m/s] */
    dem_vec *force;        /* on one that takes steps, in the last one [N] */
    double *work;          /* of the field along the flight [J] */
    double *booked;        /* part of it that the ledger has [J] */
} dem__field;
#define DEM__NO_FLIGHT INT64_MAX

/* Where energy went. Written by ledger.h. */
typedef struct dem__ledger {
    int on, started;     /* are the arrays there; has a run with DEM_ENERGY begun? */
    int counts;          /* had the last run DEM_ENERGY? */
    double paused_error; /* [J] when a run without it began */
    dem_energy_ledger sums;
} dem__ledger;

/* Memory for the moment. */
typedef struct dem__work dem__work;
typedef struct dem__scratch {
    dem__work *work; /* of each thread, in a run */
    int works;
    size_t work_bytes;
    int32_t *index; /* of each particle */
} dem__scratch;

/* Whether OpenMP's threads pay. Written by parallel.h; no result depends on it. */
typedef struct dem__pace {
    double loss;              /* time lost by waiting, since it was made up for [s] */
    double alone_until, rest; /* time until which loops run alone; for how long they last did [s] */
} dem__pace;

typedef struct dem__engine {
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

/* Every contact: DEM__EACH_CONTACT(w, c) { .. slot c .. }; break leaves a chunk only. */
#define DEM__EACH_CONTACT(w, c)                                                                                                            \
    for (const dem__chunk *in_##c = (w)->engine->contacts.chunk; in_##c < (w)->engine->contacts.chunk + (w)->engine->contacts.chunk_count; \
         in_##c++)                                                                                                                         \
        for (ptrdiff_t c = in_##c->first; c < in_##c->first + in_##c->count; c++)
