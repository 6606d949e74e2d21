/* What a feature adds to spheres and walls, as a table of functions: links, rigid bodies, polyhedra, a force field, the
   energy ledger, fixed particles, meshes. The members say when the engine calls them. dem__add_feature adds a table
   when the feature is first used or loaded, so a program that never names a feature compiles none of it. Members that a
   feature does not need are NULL. None is called for a single contact. */
#pragma once
#include "api.h"
#include "polyhedron.h"

/* An array of a group. Growing, freeing and saving loop over lists of them. */
typedef struct dem__array {
    void *address; /* of the pointer to it */
    size_t size;   /* of an entry [bytes] */
} dem__array;
enum {
    DEM__ARRAYS_MAX = 64 + DEM_STATE_MAX + DEM_CONSTANTS_MAX,
    DEM__STEP_ARRAYS = 3,
    DEM__OUT_ARRAYS = 9,
    DEM__OWN_ARRAYS = 4
};

/* Particles first .. end-1, which move as one. */
typedef struct dem__pieces {
    ptrdiff_t first, end;
} dem__pieces;

struct dem__group;
struct dem__stream;
struct dem__file;

/* Features are called in this order. */
enum {
    DEM__LEDGER_FEATURE,
    DEM__FIXED_FEATURE,
    DEM__LINKS_FEATURE,
    DEM__FIELD_FEATURE,
    DEM__MESHES_FEATURE,
    DEM__BODIES_FEATURE,
    DEM__POLYHEDRA_FEATURE,
    DEM__FEATURES_MAX
};

typedef struct dem__feature {
    int place;      /* DEM__LEDGER_FEATURE and so on */
    int adds_loads; /* it adds to the loads of particles */
    int turns;      /* its particles may turn without friction */
    int sorts;      /* in a run particles may lie in another order: the feature knows them only by its arrays, and sums
                       nothing in the order of particles */
    int exclusive;  /* it moves particles between steps; a world has at most one such feature */

    /* Memory. */
    int (*list_arrays)(dem_world *w, dem__array *list); /* lists its arrays of particles; returns their number */
    int (*list_contact_arrays)(dem_world *w, dem__array *list); /* the same of contacts */
    void (*release)(dem_world *w);                              /* frees its own memory */

    /* Particles come, are changed by the caller, and leave. */
    void (*add_particle)(dem_world *w, ptrdiff_t i);       /* sets its data of a new particle */
    void (*begin_change)(dem_world *w, dem__pieces of);    /* before the caller changes how some particles move */
    void (*end_change)(dem_world *w, dem__pieces of);      /* after it */
    void (*set_time_step)(dem_world *w);                   /* the time step has changed */
    void (*remove_particle)(dem_world *w, ptrdiff_t i);    /* particle i leaves */
    void (*renumber)(dem_world *w, const int32_t *number); /* particles have new indices; -1: removed */

    /* A run. */
    dem_status (*check_run)(const dem_world *w, const dem_kernel *kernel); /* returns what prevents it, or DEM_OK */
    int (*prepare_run)(dem_world *w);                                      /* lists are new; 0 after a failure */
    void (*set_law)(dem_world *w, const dem_kernel *kernel);               /* law and features of the run are set */
    void (*find_forces)(dem_world *w); /* before forces are computed while no time passes, and after that */
    void (*forces_found)(dem_world *w);
    void (*begin_run)(dem_world *w);         /* before its first step */
    void (*begin_ledger)(dem_world *w);      /* the energy ledger begins */
    int (*end_run)(dem_world *w, int going); /* going: no failure so far; returns 0 after one */

    /* The list of near pairs. */
    void (*keep_up)(dem_world *w);      /* before the list is checked or built */
    dem_status (*listed)(dem_world *w); /* the list is new */
    double (*drift)(const dem_world *w,
                    ptrdiff_t i); /* change of particle i's velocity that single steps do not show [m/s] */

    int (*begins_early)(const dem_world *w, ptrdiff_t i, ptrdiff_t j,
                        int32_t element); /* whether i and j begin a contact below touch_gap */

    /* A step, in this order. */
    int (*begin_step)(dem_world *w);                       /* 0 after a failure */
    void (*follow)(dem_world *w, int64_t step);            /* moves its contacts to a step */
    void (*detect)(dem_world *w, int64_t step);            /* finds its own contacts at a step */
    void (*contacts_begun)(dem_world *w, ptrdiff_t begun); /* so many contacts begin, listed in contacts.slots */
    void (*add_forces)(dem_world *w, double h);            /* after those of contacts; h: length of the step [s] */
    void (*kick)(dem_world *w, double h);                  /* velocities move to the end of the step: its own, */
    void (*kicked)(dem_world *w);                          /* and after those of all active particles */
    void (*corrected)(dem_world *w);                       /* after the impulses and shifts of partial steps */
    void (*end_contact)(dem_world *w, ptrdiff_t c);        /* the contact in slot c ends */
    void (*leave)(dem_world *w);                           /* before particles that passed an exit are removed */
    int (*begin_flights)(dem_world *w);                    /* after bounds have been checked; 0 after a failure */
    int (*end_step)(dem_world *w);                         /* 0 after a failure */

    /* Reading. */
    /* how many forces of the feature act between particles */
    ptrdiff_t (*forces)(const dem_world *w);
    dem_contact_info (*force)(const dem_world *w, ptrdiff_t k); /* one of them */
    dem_vec (*velocity_error)(const dem_world *w, ptrdiff_t i,
                              double tau);                              /* error of a velocity on the parabola */
    void (*correct_velocity)(dem_world *w, ptrdiff_t i, dem_vec error); /* adds it at a new origin */
    void (*open_books)(const dem_world *w, ptrdiff_t i, dem_energy_ledger *sums); /* adds what is not booked yet */

    /* Saving. */
    void (*world_fields)(dem_world *w, struct dem__group *g);    /* adds its fields of the world */
    void (*particle_fields)(dem_world *w, struct dem__group *g); /* adds its fields of particles */
    void (*contact_fields)(dem_world *w, struct dem__group *g);
    void (*save)(struct dem__stream *s, dem_world *w, struct dem__group *g);
    /* whether a loaded world has it, once its fields of the world are read; -1: these are not valid */
    int (*is_used)(const struct dem__file *file, const dem_world *w);
    dem_status (*load_first)(const struct dem__file *file, dem_world *w, struct dem__group *g); /* before particles */
    dem_status (*load)(const struct dem__file *file, dem_world *w, struct dem__group *g);
    void (*loaded)(dem_world *w); /* derives what is not saved, after everything has been loaded */
    void (*hash_particle)(uint64_t *hash, const dem_world *w, ptrdiff_t i);
    void (*hash_before_contacts)(uint64_t *hash, const dem_world *w);
    void (*hash)(uint64_t *hash, const dem_world *w);
} dem__feature;

/* Returns a table without members. */
static inline dem__feature dem__new_feature(int place) {
    dem__feature feature;
    memset(&feature, 0, sizeof feature);
    feature.place = place;
    return feature;
}
