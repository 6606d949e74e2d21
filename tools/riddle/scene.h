/* scene.h: the world that a scene file describes, its feeds and its liquid, in time. It runs in ticks of equal length:
   whatever is fed, switched, measured or saved is so between two ticks. What a tick does depends only on what
   scene_exchange() saves. */
#ifndef RIDDLE_SCENE_H
#define RIDDLE_SCENE_H

#include <stdint.h>

#include "common.h"
#include "dem_io.h"
#include "scene_def.h"
#include "state.h"

/* A clump, a convex polyhedron or a compound of them of the file, as it was drawn. */
typedef struct body_shape {
    const shape_def *def;
    dem_clump clump; /* no spheres: a polyhedron or a compound */
    dem_convex polyhedron;
    int parts;            /* above 0: a compound */
    dem_convex *part;     /* [parts] */
    double *place, *turn; /* [parts][3] of their origins [m]; [parts][4], quaternions */
    dem_clump_fit fit; /* of a clump that is made from a mesh */
    double diameter;   /* of the sphere of its volume [m] */
    double reach;    /* its farthest point from the centre, over half that diameter [-] */
} body_shape;

/* One class of sizes of one feed. */
typedef struct source {
    const feed_def *def;
    const body_shape *shape; /* NULL: spheres */
    dem_feed *feed;          /* of the scene's list: those of a feed stand together */
    dem_compound *compound;  /* of the scene's world; NULL: bodies are none */
    int group;
    double density;      /* [kg/m3] */
    double square, cube; /* means of d^2, d^3 by number [m2], [m3] */
    double film;         /* thickness of liquid on a particle [m] */
} source;

/* One feed of the file: its classes come in turn, so that all have their shares whatever finds room. */
typedef struct scene_feeder {
    dem_source source;
    struct source *first; /* of its classes */
    double done;          /* 1: all at once, and that has been */
    double asked;         /* of a rate: so far [kg] */
} scene_feeder;

/* Particles that are told apart: a class of sizes of a label and a material. */
typedef struct size_group {
    char name[64];
    double density;
    double low,
        high; /* its class [m]: equal for a single size; 0, infinite: below the finest, above the coarsest sieve */
    double fed, passed; /* [kg] */
} size_group;

/* Sums over particles of a class that came, or left by an exit. */
typedef struct tally {
    double count, mass;
    double sized;       /* sum of mass x diameter [kg m] */
    double under;       /* mass of those finer than the cut of the separation [kg] */
    double aged, aged2; /* sums of mass x time since they came, and of its square [kg s], [kg s2] */
} tally;

struct wet_scene;
struct contact_laws;

typedef struct scene {
    const scene_def *def;
    tree_file *file;
    int threads, features;
    uint64_t seed;
    dem_world world;
    int wall_of[DEM_WALLS_MAX]; /* index in the world of a wall of the file */
    body_shape *shape;          /* [def->shapes.n] */
    source *source;
    dem_feed *feed; /* [sources] */
    double *share;  /* [sources] of the class in its feed, of mass or number as the file says */
    int sources;
    scene_feeder *feeder; /* [def->feeds.n] */
    size_group *group;
    int groups;
    double *sieve; /* [sieves] rising; none: classes are those of the feeds [m] */
    int sieves;
    struct books *books;
    double exit_mass[DEM_WALLS_MAX]; /* [kg] by wall of the world */
    double tick;                     /* [s] */
    double ticks;                    /* done; a whole number */
    double beyond; /* time since the last of them [s]: 0, but at the end of a run that ends within one */
    struct wet_scene *wet;
    int *wet_class; /* by id */
    int wet_room;
    double liquid; /* fed so far [m3] */
    struct contact_laws *laws; /* NULL: a law of dem.h alone */
} scene;

/* The world with its walls, before the first feed. 0, or -1 with the message in the file. Free with scene_free
   in both cases. */
int scene_make(scene *s, const scene_def *def, tree_file *file, uint64_t seed, int threads);
void scene_free(scene *s);
double scene_time(const scene *s); /* [s] */
/* Feeds what is due and runs a tick. */
dem_status scene_advance(scene *s);
/* Whether the next tick would end after the duration; then what is left of the duration [s], 0 at its end. */
int scene_near_end(const scene *s, double *left);
/* Runs that, the last of a run. A save must be before it: who goes on from there runs the whole tick. */
dem_status scene_finish(scene *s, double left);
/* Everything that the future depends on, into or out of a state. */
int scene_exchange(scene *s, scene_state *io);
/* What found no place [-], [kg]; by how much steady feeds lag [kg], of what was asked of them so far [kg]. */
typedef struct scene_lack {
    double missed, missed_mass, late, asked;
} scene_lack;
scene_lack scene_missed(const scene *s);

#endif
