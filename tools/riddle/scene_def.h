/* scene_def.h: what a scene file says, as structs; their tables stand in scene_def.c. SI units; NaN: not given. */
#ifndef RIDDLE_SCENE_DEF_H
#define RIDDLE_SCENE_DEF_H

#include "fields.h"

typedef struct material_def {
    scene_part part;
    const char *ready;
    double density, young_modulus, poisson_ratio;
} material_def;

typedef struct bond_def {
    scene_part part;
    double modulus, shear_ratio, radius, damping, tensile, shear;
} bond_def;
typedef struct contact_def {
    scene_part part;
    const char *between[2];
    double stiffness, tangential_ratio, restitution, friction, rolling, tangential_damping;
    int dashpot;
    double rolling_coefficient, rolling_damping, twisting_coefficient, surface_energy;
    bond_def bond;
} contact_def;

/* ---- walls ---- */

typedef struct plane_shape {
    scene_part part;
    double point[3], normal[3];
} plane_shape;
typedef struct box_shape {
    scene_part part;
    double size[3], centre[3], axis[3], angle;
    int open;
} box_shape;
typedef struct cylinder_shape {
    scene_part part;
    double point[3], axis[3], radius;
    int side;
} cylinder_shape;
typedef struct cone_shape {
    scene_part part;
    double low[3], high[3], low_radius, high_radius;
} cone_shape;
typedef struct disc_shape {
    scene_part part;
    double centre[3], normal[3], radius, hole_radius;
} disc_shape;
typedef struct ball_shape {
    scene_part part;
    double centre[3], radius;
    int side;
} ball_shape;
typedef struct screen_shape {
    scene_part part;
    double aperture, wire, radius, length, width, centre[3], normal[3], direction[3];
    int profile;
} screen_shape;
typedef struct mesh_shape {
    scene_part part;
    const char *file;
    double unit, weld, centre[3], axis[3], angle;
} mesh_shape;
typedef struct lifters_shape {
    scene_part part;
    double count, radius, height, thickness, length, centre[3], axis[3], tilt, first;
} lifters_shape;

typedef struct vibration {
    scene_part part;
    double amplitude[3], phase[3], frequency;
} vibration;
typedef struct rotation {
    scene_part part;
    double centre[3], axis[3], speed;
} rotation;
typedef struct straight_motion {
    scene_part part;
    double velocity[3];
} straight_motion;
typedef struct belt_motion {
    scene_part part;
    double velocity[3], axis[3], speed;
} belt_motion;
typedef struct piston {
    scene_part part;
    double axis[3], mass, force, damping;
} piston;
typedef struct rotor {
    scene_part part;
    double centre[3], axis[3], inertia, torque, damping;
} rotor;

typedef struct wall_def {
    scene_part part; /* of the walls' name */
    const char *material;
    plane_shape plane, exit;
    box_shape box;
    cylinder_shape cylinder;
    cone_shape cone;
    disc_shape disc;
    ball_shape sphere;
    screen_shape screen;
    mesh_shape mesh;
    lifters_shape lifters;
    vibration vibrate;
    rotation rotate;
    straight_motion move;
    belt_motion belt;
    piston piston;
    rotor rotor;
    scene_list timetable; /* double[2] */
    int load_map;
    double from, until;
} wall_def;

/* ---- shapes ---- */

enum { SHAPE_SPHERES_MAX = 64, SHAPE_CORNERS_MAX = 32, SHAPE_PARTS_MAX = 64 }; /* as dem.h has them */

typedef struct shape_sphere {
    scene_part part;
    double centre[3], diameter;
} shape_sphere;
typedef struct shape_mesh {
    scene_part part;
    const char *file;
    double unit, weld, tolerance, spheres;
    int hull;
} shape_mesh;
typedef struct shape_tablet {
    scene_part part;
    double diameter, height, band;
} shape_tablet;
typedef struct shape_capsule {
    scene_part part;
    double diameter, length;
} shape_capsule;
typedef struct shape_gravel {
    scene_part part;
    double diameter, elongation, flatness, corners, seed;
} shape_gravel;
typedef struct shape_def {
    scene_part part;                    /* of the shapes' name; of a part of a shape: none */
    scene_list spheres, corners, parts; /* parts: shape_def */
    double at[3], axis[3], angle;       /* of a part */
    double box[3], rounding;
    shape_mesh mesh;
    shape_tablet tablet;
    shape_capsule capsule;
    shape_gravel gravel;
} shape_def;

/* ---- feed ---- */

typedef struct box_region {
    scene_part part;
    double low[3], high[3];
} box_region;
typedef struct cylinder_region {
    scene_part part;
    double bottom[3], axis[3], length, radius;
} cylinder_region;
typedef struct ball_region {
    scene_part part;
    double centre[3], radius;
} ball_region;
typedef struct region_def {
    scene_part part;
    box_region box;
    cylinder_region cylinder;
    ball_region sphere;
} region_def;

typedef struct size_class {
    scene_part part;
    double diameter, share;
} size_class;
typedef struct even_sizes {
    scene_part part;
    double smallest, largest;
} even_sizes;
typedef struct lognormal_sizes {
    scene_part part;
    double median, spread, smallest, largest;
} lognormal_sizes;
typedef struct rosin_sizes {
    scene_part part;
    double scale, exponent, smallest, largest;
} rosin_sizes;
typedef struct sizes_def {
    scene_part part;
    double diameter;
    scene_list classes;
    const char *file;
    even_sizes uniform;
    lognormal_sizes lognormal;
    rosin_sizes rosin_rammler;
    int shares;
} sizes_def;

typedef struct feed_def {
    scene_part part;
    const char *material, *shape, *label;
    sizes_def sizes;
    region_def region;
    double mass, count, rate;
    double velocity[3], scatter[3], from, until, tries;
} feed_def;

typedef struct liquid_def {
    scene_part part;
    double moisture, density, surface_tension, viscosity, angle, deck_angle, wall_angle;
} liquid_def;

/* ---- what comes out ---- */

typedef struct measured_region {
    scene_part part;
    region_def region;
} measured_region;
typedef struct mixing_def {
    scene_part part;
    box_region box;
    double cells[3];
    const char *of;
} mixing_def;
typedef struct heap_def {
    scene_part part;
    double centre[3], radius;
} heap_def;
typedef struct separation_def {
    scene_part part;
    const char *fine, *coarse;
    double cut, from;
} separation_def;
typedef struct measure_def {
    scene_part part;
    double every;
    scene_list sieves; /* double */
    int series, by_class;
    scene_list regions, mixing, heaps; /* measured_region, mixing_def, heap_def */
    separation_def separation;
} measure_def;
typedef struct output_def {
    scene_part part;
    double frames, tables, picture, save, view[3], top_speed;
    int colour, movie;
    double movie_rate;
    const char *curves;
    int passed;
} output_def;
typedef struct stop_def {
    scene_part part;
    const char *column;
    double below, above, after;
} stop_def;
typedef struct axis_def {
    scene_part part;
    double low, high;
} axis_def;
typedef struct periodic_def {
    scene_part part;
    axis_def axis[3];
} periodic_def;

/* As the words of the key `law` stand. */
typedef enum scene_law { LAW_LINEAR, LAW_HERTZ, LAW_EPSD, LAW_EPSD_HERTZ, LAW_DMT, LAW_JKR, LAW_BONDS } scene_law;

typedef struct scene_def {
    scene_part part;
    const char *title;
    double duration, time_step, gravity[3], seed, bond_at;
    int law; /* scene_law */
    scene_list materials, contacts, walls, shapes, feeds, stop;
    periodic_def periodic;
    liquid_def liquid;
    measure_def measure;
    output_def output;
} scene_def;

extern const scene_table scene_section;

/* Reads and checks all that a file alone can tell; 0, or -1 with the message in the file. */
int scene_read(tree_file *file, scene_def *scene);

#endif
