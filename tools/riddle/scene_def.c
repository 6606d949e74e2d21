/* scene_def.c: the keys of a scene file. This table is the reader, the checks, the defaults and the reference
   (docs/scene_files.md). */
#include "scene_def.h"

#include <math.h>
#include <string.h>

#include "scene_materials.h"

#define ANY -HUGE_VAL, HUGE_VAL, false
#define POSITIVE 0.0, 1e30, true
#define AT_LEAST_0 0.0, 1e30, false
#define MUST NULL
#define NO_WORDS NULL, NULL
#define SECTION(name, type, title, help)                                                                               \
    static const scene_table name##_section = {title, help, name##_fields,                                             \
                                               (int)(sizeof name##_fields / sizeof *name##_fields), sizeof(type)}
#define NUMBER(type, member, unit, range, fallback, help)                                                              \
    { #member, FIELD_NUMBER, unit, offsetof(type, member), range, fallback, 0, NO_WORDS, help }
#define ONE_NUMBER(type, member, kind, unit, range, group, help)                                                       \
    { #member, kind, unit, offsetof(type, member), range, "", group, NO_WORDS, help }
#define VECTOR(type, member, unit, fallback, help)                                                                     \
    { #member, FIELD_VECTOR, unit, offsetof(type, member), ANY, fallback, 0, NO_WORDS, help }
#define TEXT(type, member, fallback, help)                                                                             \
    { #member, FIELD_TEXT, UNIT_NONE, offsetof(type, member), ANY, fallback, 0, NO_WORDS, help }
#define FILE_NAME(type, member, help)                                                                                  \
    { #member, FIELD_FILE, UNIT_NONE, offsetof(type, member), ANY, MUST, 0, NO_WORDS, help }
#define CHOICE(type, member, words, fallback, help)                                                                    \
    { #member, FIELD_CHOICE, UNIT_NONE, offsetof(type, member), ANY, fallback, 0, words, NULL, help }
#define PART(type, member, below, fallback, group, help)                                                               \
    { #member, FIELD_PART, UNIT_NONE, offsetof(type, member), ANY, fallback, group, NULL, &below##_section, help }
#define LIST(type, member, kind, below, most, fallback, help)                                                          \
    { #member, kind, UNIT_NONE, offsetof(type, member), 1, most, false, fallback, 0, NULL, &below##_section, help }

/* ---- materials ---- */

static const scene_field material_fields[] = {
    TEXT(material_def, ready, "",
         "name of a ready material, which supplies the values left out here: glass, steel, pvc, limestone, wheat, "
         "polypropylene"),
    NUMBER(material_def, density, UNIT_DENSITY, POSITIVE, "", "of the solid; must be given without `ready`"),
    NUMBER(material_def, young_modulus, UNIT_STRESS, POSITIVE, "1e10",
           "used by `law: hertz`, and there for the time step"),
    {"poisson_ratio", FIELD_NUMBER, UNIT_NONE, offsetof(material_def, poisson_ratio), 0.0, 0.5, false, "0.25", 0,
     NO_WORDS, "used by `law: hertz`, and there for the time step"},
};
SECTION(material, material_def, "material", "A material of particles or walls. At most 8.");

static const scene_field bond_fields[] = {
    NUMBER(bond_def, modulus, UNIT_STRESS, POSITIVE, MUST,
           "Young's modulus of the bond, a round beam between the centres"),
    NUMBER(bond_def, shear_ratio, UNIT_NONE, AT_LEAST_0, "0.4", "its shear stiffness over the normal one"),
    NUMBER(bond_def, radius, UNIT_NONE, POSITIVE, "1", "its radius over the smaller sphere's"),
    NUMBER(bond_def, damping, UNIT_NONE, AT_LEAST_0, "0.1", "share of the critical damping of its stretching"),
    NUMBER(bond_def, tensile, UNIT_STRESS, POSITIVE, MUST, "strength against pull and bending"),
    NUMBER(bond_def, shear, UNIT_STRESS, POSITIVE, MUST, "strength against shear and twisting"),
};
SECTION(bond, bond_def, "bond",
        "A bond that breaks, of two spheres or a sphere and a wall; once broken, an ordinary contact.");

static const scene_field contact_fields[] = {
    {"between", FIELD_TWO, UNIT_NONE, offsetof(contact_def, between), ANY, MUST, 0, NO_WORDS,
     "names of two materials, or of one twice"},
    NUMBER(contact_def, stiffness, UNIT_STIFFNESS, POSITIVE, "1e5",
           "normal; `law: linear` only. Overlaps (column `largest_overlap`) should stay below 1 % of a diameter"),
    {"tangential_ratio", FIELD_NUMBER, UNIT_NONE, offsetof(contact_def, tangential_ratio), 0.0, 1.0, false,
     "0.2857142857142857", 0, NO_WORDS, "tangential over normal stiffness; `law: linear` only"},
    {"restitution", FIELD_NUMBER, UNIT_NONE, offsetof(contact_def, restitution), 0.0, 1.0, true, "0.8", 0, NO_WORDS,
     "coefficient of restitution"},
    NUMBER(contact_def, friction, UNIT_NONE, AT_LEAST_0, "0.3", "Coulomb's coefficient"),
    NUMBER(contact_def, rolling, UNIT_LENGTH, AT_LEAST_0, "0",
           "lever arm of rolling resistance; on a slope below this limit a ball creeps at 5 g sin(slope) dt: `law: "
           "epsd` holds it"),
    NUMBER(contact_def, tangential_damping, UNIT_NONE, AT_LEAST_0, "0", "tangential dashpot over the normal one"),
    CHOICE(contact_def, dashpot, "clipped|naive", "clipped", "clipped: it never pulls; `law: linear` only"),
    NUMBER(contact_def, rolling_coefficient, UNIT_NONE, AT_LEAST_0, "0",
           "the greatest rolling torque over normal force and R* = R_i R_j/(R_i + R_j), the tangent of the slope on "
           "which a ball begins "
           "to roll; `law: epsd, epsd_hertz`"),
    NUMBER(contact_def, rolling_damping, UNIT_NONE, AT_LEAST_0, "0.3",
           "share of the critical damping of the rolling spring; `law: epsd, epsd_hertz`"),
    NUMBER(contact_def, twisting_coefficient, UNIT_NONE, AT_LEAST_0, "0",
           "as `rolling_coefficient`, about the normal; `law: epsd, epsd_hertz`"),
    NUMBER(contact_def, surface_energy, UNIT_TENSION, AT_LEAST_0, "0",
           "work of adhesion of both surfaces together; `law: dmt, jkr`"),
    PART(contact_def, bond, bond, "", 0, "without it this pair does not bond; `law: bonds`"),
};
SECTION(contact, contact_def, "contact",
        "How two materials touch. A material has the defaults with itself; two that differ and touch must be listed.");

/* ---- walls ---- */

static const scene_field plane_fields[] = {
    VECTOR(plane_shape, point, UNIT_LENGTH, "[0, 0, 0]", "any point of it"),
    VECTOR(plane_shape, normal, UNIT_NONE, "[0, 0, 1]", "particles are on this side; of any length"),
};
SECTION(plane, plane_shape, "plane", "An endless plane; as an `exit`, what passes it is counted and taken out.");
static const scene_field box_fields[] = {
    VECTOR(box_shape, size, UNIT_LENGTH, MUST, "along x, y, z before it is turned"),
    VECTOR(box_shape, centre, UNIT_LENGTH, "[0, 0, 0]", "of the box"),
    VECTOR(box_shape, axis, UNIT_NONE, "[0, 1, 0]", "it is turned about this axis through its centre"),
    NUMBER(box_shape, angle, UNIT_ANGLE, ANY, "0", "by this angle"),
    CHOICE(box_shape, open, "no|top|bottom|both", "no", "faces that are left out: a container without a lid"),
};
SECTION(box, box_shape, "box", "A box of thin faces, touched from both sides: a block or a container.");
static const scene_field cylinder_fields[] = {
    VECTOR(cylinder_shape, point, UNIT_LENGTH, "[0, 0, 0]", "any point of its axis"),
    VECTOR(cylinder_shape, axis, UNIT_NONE, "[0, 0, 1]", "its direction"),
    NUMBER(cylinder_shape, radius, UNIT_LENGTH, POSITIVE, MUST, "of the surface"),
    CHOICE(cylinder_shape, side, "outside|inside", "inside", "where the particles are"),
};
SECTION(cylinder, cylinder_shape, "cylinder",
        "An endless cylinder. For a tube that ends, take `cone` with equal radii.");
static const scene_field cone_fields[] = {
    VECTOR(cone_shape, low, UNIT_LENGTH, MUST, "centre of one end"),
    VECTOR(cone_shape, high, UNIT_LENGTH, MUST, "centre of the other end"),
    NUMBER(cone_shape, low_radius, UNIT_LENGTH, AT_LEAST_0, MUST, "at the low end; 0: a tip"),
    NUMBER(cone_shape, high_radius, UNIT_LENGTH, AT_LEAST_0, MUST, "at the high end; 0: a tip"),
};
SECTION(cone, cone_shape, "cone", "A cone, frustum or tube that ends: a thin sheet, touched from both sides.");
static const scene_field disc_fields[] = {
    VECTOR(disc_shape, centre, UNIT_LENGTH, "[0, 0, 0]", "of the disc"),
    VECTOR(disc_shape, normal, UNIT_NONE, "[0, 0, 1]", "perpendicular to it; of any length"),
    NUMBER(disc_shape, radius, UNIT_LENGTH, POSITIVE, MUST, "of its outer rim"),
    NUMBER(disc_shape, hole_radius, UNIT_LENGTH, AT_LEAST_0, "0", "of a round hole in its middle; less than `radius`"),
};
SECTION(disc, disc_shape, "disc", "A flat, thin disc, touched from both sides: a bottom, with or without a hole.");
static const scene_field ball_fields[] = {
    VECTOR(ball_shape, centre, UNIT_LENGTH, "[0, 0, 0]", "of the sphere"),
    NUMBER(ball_shape, radius, UNIT_LENGTH, POSITIVE, MUST, "of the surface"),
    CHOICE(ball_shape, side, "outside|inside", "outside", "where the particles are"),
};
SECTION(ball, ball_shape, "sphere", "A sphere as a wall.");
static const scene_field screen_fields[] = {
    NUMBER(screen_shape, aperture, UNIT_LENGTH, POSITIVE, MUST, "clear width between wires"),
    NUMBER(screen_shape, wire, UNIT_LENGTH, POSITIVE, MUST, "diameter of the wires"),
    ONE_NUMBER(screen_shape, radius, FIELD_NUMBER, UNIT_LENGTH, POSITIVE, 1, "of a round screen"),
    ONE_NUMBER(screen_shape, length, FIELD_NUMBER, UNIT_LENGTH, POSITIVE, 1,
               "of a rectangular one, along `direction`. A whole odd number of pitches puts a wire on both edges"),
    NUMBER(screen_shape, width, UNIT_LENGTH, POSITIVE, "",
           "of a rectangular one, across; as `length` if it is not given"),
    VECTOR(screen_shape, centre, UNIT_LENGTH, "[0, 0, 0]", "in the plane of the wires, the centre of an aperture"),
    VECTOR(screen_shape, normal, UNIT_NONE, "[0, 0, 1]", "up; an inclined deck has an inclined one"),
    VECTOR(screen_shape, direction, UNIT_NONE, "[1, 0, 0]", "along one family of wires"),
    CHOICE(screen_shape, profile, "round|flat_below", "round", "of the wires"),
};
SECTION(screen, screen_shape, "screen", "A woven wire screen with square apertures.");
static const scene_field mesh_fields[] = {
    FILE_NAME(mesh_shape, file,
              "an STL file, text or binary; its name is relative to the scene's folder. Refused if triangles are "
              "missing; `--check` counts "
              "open edges"),
    NUMBER(mesh_shape, unit, UNIT_LENGTH, POSITIVE, "1e-3", "length of one unit of the file; 1 mm as CAD writes it"),
    NUMBER(mesh_shape, weld, UNIT_LENGTH, AT_LEAST_0, "0", "corners nearer than this become one"),
    VECTOR(mesh_shape, centre, UNIT_LENGTH, "[0, 0, 0]", "where the origin of the file is put"),
    VECTOR(mesh_shape, axis, UNIT_NONE, "[0, 0, 1]", "it is turned about this axis through the file's origin"),
    NUMBER(mesh_shape, angle, UNIT_ANGLE, ANY, "0", "by this angle"),
};
SECTION(mesh, mesh_shape, "mesh", "Triangles from a file: thin sheets, touched from both sides.");
static const scene_field lifters_fields[] = {
    {"count", FIELD_WHOLE, UNIT_NONE, offsetof(lifters_shape, count), 1.0, 1000.0, false, MUST, 0, NO_WORDS,
     "evenly around"},
    NUMBER(lifters_shape, radius, UNIT_LENGTH, POSITIVE, MUST, "of the drum: where they stand"),
    NUMBER(lifters_shape, height, UNIT_LENGTH, POSITIVE, MUST, "inwards"),
    NUMBER(lifters_shape, thickness, UNIT_LENGTH, POSITIVE, MUST, "around"),
    NUMBER(lifters_shape, length, UNIT_LENGTH, POSITIVE, MUST, "along the axis"),
    VECTOR(lifters_shape, centre, UNIT_LENGTH, "[0, 0, 0]", "of the drum"),
    VECTOR(lifters_shape, axis, UNIT_NONE, "[0, 1, 0]", "of the drum"),
    NUMBER(lifters_shape, tilt, UNIT_ANGLE, ANY, "0", "of each against the radius"),
    NUMBER(lifters_shape, first, UNIT_ANGLE, ANY, "0", "where the first stands: its angle about the axis"),
};
SECTION(lifters, lifters_shape, "lifters", "Bars along a drum's wall, which form one wall.");

static const scene_field vibration_fields[] = {
    VECTOR(vibration, amplitude, UNIT_LENGTH, MUST, "half the stroke, by component"),
    NUMBER(vibration, frequency, UNIT_FREQUENCY, AT_LEAST_0, MUST, "of all components"),
    VECTOR(vibration, phase, UNIT_ANGLE, "[0, 0, 0]", "[90 deg, 0, 0] and equal amplitudes: a circle"),
};
SECTION(vibration, vibration, "vibrate", "Displacement A (sin(2 pi f t + phase) - sin(phase)).");
static const scene_field rotation_fields[] = {
    VECTOR(rotation, centre, UNIT_LENGTH, "[0, 0, 0]", "a point of the axis"),
    VECTOR(rotation, axis, UNIT_NONE, MUST, "its direction; counter-clockwise seen against it"),
    NUMBER(rotation, speed, UNIT_SPIN, ANY, MUST, "constant"),
};
SECTION(rotation, rotation, "rotate", "Rotation about a fixed axis.");
static const scene_field straight_fields[] = {VECTOR(straight_motion, velocity, UNIT_SPEED, MUST, "constant")};
SECTION(straight, straight_motion, "move", "Motion at constant velocity.");
static const scene_field belt_fields[] = {
    VECTOR(belt_motion, velocity, UNIT_SPEED, "", "of the surface, or its part along the surface"),
    VECTOR(belt_motion, axis, UNIT_NONE, "",
           "of the pulleys, instead of `velocity`: the surface runs around it, at `speed` everywhere"),
    NUMBER(belt_motion, speed, UNIT_SPEED, ANY, "", "of the surface, with `axis`: along axis x normal"),
};
SECTION(belt, belt_motion, "belt", "Only the surface runs: `velocity`, or `axis` and `speed`.");
static const scene_field piston_fields[] = {
    VECTOR(piston, axis, UNIT_NONE, MUST, "it moves along this only"),
    NUMBER(piston, mass, UNIT_MASS, POSITIVE, MUST, "20 times a particle's or more; its weight does not count"),
    NUMBER(piston, force, UNIT_FORCE, ANY, MUST, "along the axis"),
    NUMBER(piston, damping, UNIT_DAMPING, AT_LEAST_0, "0", "of its motion"),
};
SECTION(piston, piston, "piston", "Moved by a force and by the particles.");
static const scene_field rotor_fields[] = {
    VECTOR(rotor, centre, UNIT_LENGTH, "[0, 0, 0]", "a point of the axis"),
    VECTOR(rotor, axis, UNIT_NONE, MUST, "its direction"),
    NUMBER(rotor, inertia, UNIT_INERTIA, POSITIVE, MUST, "about the axis"),
    NUMBER(rotor, torque, UNIT_TORQUE, ANY, MUST, "about the axis"),
    NUMBER(rotor, damping, UNIT_NONE, AT_LEAST_0, "0", "of its motion, in N m s/rad"),
};
SECTION(rotor, rotor, "rotor", "Turned by a torque and by the particles.");

static const scene_field wall_fields[] = {
    TEXT(wall_def, material, "", "name of a material; an exit needs none"),
    PART(wall_def, plane, plane, "", 1, "an endless plane"),
    PART(wall_def, box, box, "", 1, "a block or a container, at any angle"),
    PART(wall_def, cylinder, cylinder, "", 1, "an endless cylinder"),
    PART(wall_def, cone, cone, "", 1, "a cone, frustum or tube"),
    PART(wall_def, disc, disc, "", 1, "a flat bottom, with or without a hole"),
    PART(wall_def, sphere, ball, "", 1, "a sphere"),
    PART(wall_def, screen, screen, "", 1, "a wire screen"),
    PART(wall_def, mesh, mesh, "", 1, "triangles from an STL file"),
    PART(wall_def, lifters, lifters, "", 1, "bars along a drum"),
    PART(wall_def, exit, plane, "", 1, "particles that pass this plane are counted and taken out"),
    PART(wall_def, vibrate, vibration, "", 0, "vibration"),
    PART(wall_def, rotate, rotation, "", 0, "rotation"),
    PART(wall_def, move, straight, "", 0, "constant velocity"),
    PART(wall_def, belt, belt, "", 0, "a surface that runs while the wall stays"),
    PART(wall_def, piston, piston, "", 0, "moved by a force"),
    PART(wall_def, rotor, rotor, "", 0, "turned by a torque"),
    {"load_map", FIELD_YES, UNIT_NONE, offsetof(wall_def, load_map), ANY, "no", 0, NO_WORDS,
     "of box, lifters and mesh: `loads_<wall>.vtp` and `.csv`, of each triangle the mean normal force and pressure, "
     "normal force x sliding "
     "(Archard's wear is proportional to it), work of friction, and energy that hits lose along the normal, over its "
     "area; from the contacts after every "
     "fifth step, so of one hit that energy is known to a third, of a hundred to a twentieth"},
    {"timetable", FIELD_PAIRS, UNIT_NONE, offsetof(wall_def, timetable), 1, 1000, false, "", 0, NO_WORDS,
     "[[0 s, 0], [2 s, 1]]: factors of the speed of `rotate`, `move` and `belt` and of the amplitude of `vibrate`; "
     "even between two times, "
     "constant before the first and after the last"},
    NUMBER(wall_def, from, UNIT_TIME, AT_LEAST_0, "0", "the wall exists from this time on; it moves all the time"),
    NUMBER(wall_def, until, UNIT_TIME, AT_LEAST_0, "", "and until this time, after `from`: a gate"),
};
SECTION(wall, wall_def, "wall", "One shape, and how it moves. At most 32 walls; an exit counts.");

/* ---- shapes ---- */

static const scene_field shape_sphere_fields[] = {
    VECTOR(shape_sphere, centre, UNIT_LENGTH, MUST, "in a frame of the shape's own, with its origin anywhere"),
    NUMBER(shape_sphere, diameter, UNIT_DIAMETER, POSITIVE, MUST, "of the sphere"),
};
SECTION(shape_sphere, shape_sphere, "sphere of a shape",
        "Spheres may overlap: the body is their union, of one density.");
static const scene_field shape_mesh_fields[] = {
    FILE_NAME(shape_mesh, file, "an STL file; its name is relative to the scene's folder"),
    NUMBER(shape_mesh, unit, UNIT_LENGTH, POSITIVE, "1e-3", "length of one unit of the file; 1 mm as CAD writes it"),
    NUMBER(shape_mesh, weld, UNIT_LENGTH, AT_LEAST_0, "0", "corners nearer than this become one"),
    CHOICE(shape_mesh, hull, "no|yes", "no",
           "no: a surface that is not closed and convex is refused; yes: its convex hull, for a scan"),
    {"tolerance", FIELD_NUMBER, UNIT_NONE, offsetof(shape_mesh, tolerance), 0.0, 0.2, false, "0", 0, NO_WORDS,
     "of the hull: as few corners as keep the surface as near, over the diameter; 0: as near as 32 corners can be"},
    {"spheres", FIELD_WHOLE, UNIT_NONE, offsetof(shape_mesh, spheres), 0.0, SHAPE_SPHERES_MAX, false, "0", 0, NO_WORDS,
     "above 0: a clump of at most so many spheres inside the closed surface, which may be concave, with its mass and "
     "moments"},
};
SECTION(shape_mesh, shape_mesh, "mesh of a shape",
        "A convex body of any number of corners, of which contacts see at most 32, or a clump.");
static const scene_field shape_tablet_fields[] = {
    NUMBER(shape_tablet, diameter, UNIT_LENGTH, POSITIVE, MUST, "of the round tablet"),
    NUMBER(shape_tablet, height, UNIT_LENGTH, POSITIVE, MUST, "over all"),
    NUMBER(shape_tablet, band, UNIT_LENGTH, AT_LEAST_0, "",
           "height of its straight side; less than `height`: with round caps; 0: a lens; default: a cylinder"),
};
SECTION(shape_tablet, shape_tablet, "tablet", "A tablet, lens or cylinder, drawn with 16 sides.");
static const scene_field shape_capsule_fields[] = {
    NUMBER(shape_capsule, diameter, UNIT_LENGTH, POSITIVE, MUST, "of the capsule"),
    NUMBER(shape_capsule, length, UNIT_LENGTH, POSITIVE, MUST, "over all, at least the diameter, at most 9.8 of it"),
};
SECTION(shape_capsule, shape_capsule, "capsule", "A row of spheres with grooves of 1 % of the radius.");
static const scene_field shape_gravel_fields[] = {
    NUMBER(shape_gravel, diameter, UNIT_LENGTH, POSITIVE, MUST, "of the sphere of the same volume"),
    {"elongation", FIELD_NUMBER, UNIT_NONE, offsetof(shape_gravel, elongation), 0.1, 1.0, false, "0.8", 0, NO_WORDS,
     "middle over longest axis"},
    {"flatness", FIELD_NUMBER, UNIT_NONE, offsetof(shape_gravel, flatness), 0.1, 1.0, false, "0.8", 0, NO_WORDS,
     "shortest over middle axis"},
    {"corners", FIELD_WHOLE, UNIT_NONE, offsetof(shape_gravel, corners), 6.0, 300.0, false, "12", 0, NO_WORDS,
     "of the grain"},
    {"seed", FIELD_WHOLE, UNIT_NONE, offsetof(shape_gravel, seed), 0.0, 9007199254740992.0, false, "1", 0, NO_WORDS,
     "another number, another grain"},
};
SECTION(shape_gravel, shape_gravel, "gravel", "A grain with corners on an ellipsoid.");
#define CONVEX_SHAPES                                                                                                  \
    {"box", FIELD_VECTOR, UNIT_LENGTH, offsetof(shape_def, box), ANY, "", 1, NO_WORDS, "a brick: its three lengths"},  \
        {"corners",                                                                                                    \
         FIELD_POINTS,                                                                                                 \
         UNIT_LENGTH,                                                                                                  \
         offsetof(shape_def, corners),                                                                                 \
         4,                                                                                                            \
         SHAPE_CORNERS_MAX,                                                                                            \
         false,                                                                                                        \
         "",                                                                                                           \
         1,                                                                                                            \
         NO_WORDS,                                                                                                     \
         "a convex polyhedron, in any order; its origin is anywhere"},                                                 \
        PART(shape_def, mesh, shape_mesh, "", 1, "a convex polyhedron from a file"),                                   \
        PART(shape_def, tablet, shape_tablet, "", 1, "a tablet, lens or cylinder"),                                    \
        PART(shape_def, gravel, shape_gravel, "", 1, "a grain of gravel")
#define ROUNDING                                                                                                       \
    {                                                                                                                  \
        "rounding", FIELD_NUMBER, UNIT_NONE, offsetof(shape_def, rounding), 0.001, 0.4, false, "0.03", 0, NO_WORDS,    \
            "radius of edges and corners of a polyhedron, over its smallest width"                                     \
    }
static const scene_field shape_part_fields[] = {
    CONVEX_SHAPES,
    VECTOR(shape_def, at, UNIT_LENGTH, "[0, 0, 0]",
           "where the part's origin is put: the middle of a box or a tablet, the origin of corners or a file"),
    VECTOR(shape_def, axis, UNIT_NONE, "[0, 0, 1]", "it is turned about this axis through its origin"),
    NUMBER(shape_def, angle, UNIT_ANGLE, ANY, "0", "by this angle"),
    ROUNDING,
};
SECTION(shape_part, shape_def, "part of a shape", "A convex body, fixed to the other parts.");
static const scene_field shape_fields[] = {
    {"spheres", FIELD_LIST, UNIT_NONE, offsetof(shape_def, spheres), 1, SHAPE_SPHERES_MAX, false, "", 1, NULL,
     &shape_sphere_section, "a clump: spheres that move as one body"},
    CONVEX_SHAPES,
    PART(shape_def, capsule, shape_capsule, "", 1, "a capsule: a clump"),
    {"parts", FIELD_LIST, UNIT_NONE, offsetof(shape_def, parts), 1, SHAPE_PARTS_MAX, false, "", 1, NULL,
     &shape_part_section,
     "a body of convex parts, which may be concave as a whole. Parts may touch; what two have in common counts twice"},
    ROUNDING,
};
SECTION(shape, shape_def, "shape",
        "Shape of the particles of a feed that are not spheres. They are oriented at random.");

/* ---- feed ---- */

static const scene_field box_region_fields[] = {
    VECTOR(box_region, low, UNIT_LENGTH, MUST, "corner"),
    VECTOR(box_region, high, UNIT_LENGTH, MUST, "opposite corner; equal along an axis: a face"),
};
SECTION(box_region, box_region, "box of a region", "Along the axes.");
static const scene_field cylinder_region_fields[] = {
    VECTOR(cylinder_region, bottom, UNIT_LENGTH, MUST, "centre of the bottom"),
    VECTOR(cylinder_region, axis, UNIT_NONE, "[0, 0, 1]", "from bottom to top"),
    NUMBER(cylinder_region, length, UNIT_LENGTH, AT_LEAST_0, MUST, "0: a disc"),
    NUMBER(cylinder_region, radius, UNIT_LENGTH, POSITIVE, MUST, "of the cylinder"),
};
SECTION(cylinder_region, cylinder_region, "cylinder of a region", "At any angle.");
static const scene_field ball_region_fields[] = {
    VECTOR(ball_region, centre, UNIT_LENGTH, MUST, "of the sphere"),
    NUMBER(ball_region, radius, UNIT_LENGTH, POSITIVE, MUST, "of the sphere"),
};
SECTION(ball_region, ball_region, "sphere of a region", "A ball.");
static const scene_field region_fields[] = {
    PART(region_def, box, box_region, "", 1, "a box"),
    PART(region_def, cylinder, cylinder_region, "", 1, "a cylinder"),
    PART(region_def, sphere, ball_region, "", 1, "a sphere"),
};
SECTION(region, region_def, "region", "A part of space.");

static const scene_field class_fields[] = {
    NUMBER(size_class, diameter, UNIT_DIAMETER, POSITIVE, MUST, "of all particles of the class"),
    {"share", FIELD_NUMBER, UNIT_SHARE, offsetof(size_class, share), 0.0, 1e30, false, "1", 0, NO_WORDS,
     "of any sum; see `shares`"},
};
SECTION(class, size_class, "class", "Particles of one diameter.");
static const scene_field even_fields[] = {
    NUMBER(even_sizes, smallest, UNIT_DIAMETER, POSITIVE, MUST, "diameter"),
    NUMBER(even_sizes, largest, UNIT_DIAMETER, POSITIVE, MUST, "diameter"),
};
SECTION(even, even_sizes, "uniform", "Every diameter has the same share.");
static const scene_field lognormal_fields[] = {
    NUMBER(lognormal_sizes, median, UNIT_DIAMETER, POSITIVE, MUST, "half is finer"),
    {"spread", FIELD_NUMBER, UNIT_NONE, offsetof(lognormal_sizes, spread), 1e-3, 5.0, false, MUST, 0, NO_WORDS,
     "standard deviation of ln d"},
    NUMBER(lognormal_sizes, smallest, UNIT_DIAMETER, POSITIVE, MUST, "cut off below"),
    NUMBER(lognormal_sizes, largest, UNIT_DIAMETER, POSITIVE, MUST, "cut off above"),
};
SECTION(lognormal, lognormal_sizes, "lognormal", "The logarithm of the diameter is normally distributed.");
static const scene_field rosin_fields[] = {
    NUMBER(rosin_sizes, scale, UNIT_DIAMETER, POSITIVE, MUST, "36.8 % is coarser"),
    {"exponent", FIELD_NUMBER, UNIT_NONE, offsetof(rosin_sizes, exponent), 0.1, 100.0, false, MUST, 0, NO_WORDS,
     "of exp(-(d/scale)^exponent)"},
    NUMBER(rosin_sizes, smallest, UNIT_DIAMETER, POSITIVE, MUST, "cut off below"),
    NUMBER(rosin_sizes, largest, UNIT_DIAMETER, POSITIVE, MUST, "cut off above"),
};
SECTION(rosin, rosin_sizes, "rosin_rammler", "Rosin & Rammler (1933).");
static const scene_field sizes_fields[] = {
    ONE_NUMBER(sizes_def, diameter, FIELD_NUMBER, UNIT_DIAMETER, POSITIVE, 1, "one size"),
    {"classes", FIELD_LIST, UNIT_NONE, offsetof(sizes_def, classes), 1, 1000, false, "", 1, NULL, &class_section,
     "any number of sizes"},
    {"file", FIELD_FILE, UNIT_NONE, offsetof(sizes_def, file), ANY, "", 1, NO_WORDS,
     "a table of sieves or classes ([forms](tables.md)); in a sieve curve a class between two sieves has uniform "
     "sizes, the finest class "
     "goes down to half the finest width, and the coarsest sieve passes everything; or `size_mm` and `share`"},
    PART(sizes_def, uniform, even, "", 1, "uniform sizes"),
    PART(sizes_def, lognormal, lognormal, "", 1, "lognormal"),
    PART(sizes_def, rosin_rammler, rosin, "", 1, "Rosin-Rammler"),
    CHOICE(sizes_def, shares, "mass|number", "mass", "quantity that shares and distributions refer to"),
};
SECTION(sizes, sizes_def, "sizes",
        "Diameters; for a shape, of the sphere of its volume. Above 1 m they need a unit. Each class is measured "
        "separately; its "
        "column is `left_<size>mm`.");

static const scene_field feed_fields[] = {
    TEXT(feed_def, material, MUST, "name of a material"),
    TEXT(feed_def, shape, "", "name of a shape; default: spheres"),
    PART(feed_def, sizes, sizes, "", 0, "sizes; must be given for spheres; without it a shape keeps its size"),
    PART(feed_def, region, region, MUST, 0, "where: particles are put there at random, without touching anything"),
    ONE_NUMBER(feed_def, mass, FIELD_NUMBER, UNIT_MASS, POSITIVE, 1, "all at once, at `from`"),
    {"count", FIELD_WHOLE, UNIT_NONE, offsetof(feed_def, count), 1.0, 1e8, false, "", 1, NO_WORDS,
     "this number of particles, all at once, at `from`"},
    ONE_NUMBER(feed_def, rate, FIELD_NUMBER, UNIT_MASS_FLOW, POSITIVE, 1, "steadily, from `from` until `until`"),
    VECTOR(feed_def, velocity, UNIT_SPEED, "[0, 0, 0]", "of new particles"),
    VECTOR(feed_def, scatter, UNIT_SPEED, "[0, 0, 0]", "largest deviation from it"),
    NUMBER(feed_def, from, UNIT_TIME, AT_LEAST_0, "0", "beginning"),
    NUMBER(feed_def, until, UNIT_TIME, AT_LEAST_0, "",
           "end of a steady feed, with `rate` only; default: that of the run"),
    {"tries", FIELD_WHOLE, UNIT_NONE, offsetof(feed_def, tries), 1.0, 1e6, false, "2000", 0, NO_WORDS,
     "random places tried for a particle"},
    TEXT(feed_def, label, "", "of its classes in figures and columns, before the size; default for a shape: its name"),
};
SECTION(feed, feed_def, "feed", "A source of particles.");

static const scene_field liquid_fields[] = {
    {"moisture", FIELD_NUMBER, UNIT_SHARE, offsetof(liquid_def, moisture), 0.0, 0.5, false, MUST, 0, NO_WORDS,
     "mass of liquid over mass of particles, as a film of equal thickness on all of a feed"},
    NUMBER(liquid_def, density, UNIT_DENSITY, POSITIVE, "1000", "of the liquid"),
    NUMBER(liquid_def, surface_tension, UNIT_TENSION, POSITIVE, "0.07275", "water at 20 C"),
    NUMBER(liquid_def, viscosity, UNIT_VISCOSITY, AT_LEAST_0, "1.002e-3", "water at 20 C"),
    {"angle", FIELD_NUMBER, UNIT_ANGLE, offsetof(liquid_def, angle), 0.0, 1.05, false, "15 deg", 0, NO_WORDS,
     "contact angle on particles"},
    {"deck_angle", FIELD_NUMBER, UNIT_ANGLE, offsetof(liquid_def, deck_angle), 0.0, 1.05, false, "45 deg", 0, NO_WORDS,
     "contact angle on screens"},
    {"wall_angle", FIELD_NUMBER, UNIT_ANGLE, offsetof(liquid_def, wall_angle), 0.0, 1.05, false, "45 deg", 0, NO_WORDS,
     "contact angle on other walls"},
};
SECTION(liquid, liquid_def, "liquid",
        "Liquid bridges where wet bodies have touched ([liquid_bridge.md](liquid_bridge.md)); with `law: linear`.");

/* ---- what comes out ---- */

static const scene_field measured_fields[] = {
    PART(measured_region, region, region, MUST, 0, "where"),
};
SECTION(measured, measured_region, "measured region",
        "Columns `<name>_count`, `_mass_kg`, `_solid_fraction`, `_coordination`, `_vx_m_s`, `_vy_m_s`, `_vz_m_s`, "
        "`_pressure_Pa`.");
static const scene_field mixing_fields[] = {
    PART(mixing_def, box, box_region, MUST, 0, "where"),
    VECTOR(mixing_def, cells, UNIT_NONE, MUST, "how many cells along x, y, z: the samples"),
    TEXT(mixing_def, of, MUST,
         "classes that are mixed into the others, by their names in `left_<class>`: `white_*`, or several with commas"),
};
SECTION(mixing, mixing_def, "mixing", "Lacey's index by time, column `<name>_lacey`: 0 separated, 1 as by chance.");
static const scene_field heap_fields[] = {
    VECTOR(heap_def, centre, UNIT_LENGTH, MUST, "of the plate under the heap"),
    NUMBER(heap_def, radius, UNIT_LENGTH, POSITIVE, MUST,
           "of the heap's foot; it is divided into 6 rings and 12 sectors"),
};
SECTION(heap, heap_def, "heap",
        "Slope of a heap by time, column `<name>_angle_deg`: that of a line through the means of rings, of the highest "
        "centre in each sector. "
        "Up is opposite to gravity.");
static const scene_field separation_fields[] = {
    TEXT(separation_def, fine, MUST, "exits of the fine product; several with commas"),
    TEXT(separation_def, coarse, "",
         "exits of the coarse product; default: all particles that have passed no exit of the fine product"),
    NUMBER(separation_def, cut, UNIT_DIAMETER, POSITIVE, "",
           "what is finer should pass; default: the aperture of the scene's screen"),
    NUMBER(separation_def, from, UNIT_TIME, AT_LEAST_0, "0",
           "what leaves from this time on counts; above 0 only with `coarse`"),
};
SECTION(separation, separation_def, "separation",
        "The partition (Tromp) curve of a run: `separation.csv`, `partition.svg`, and d50, probable error Ep = (d75 - "
        "d25)/2, efficiency "
        "(Hancock: share of the undersize that passes minus that of the oversize) and others in `results.csv`.");
static const scene_field measure_fields[] = {
    NUMBER(measure_def, every, UNIT_TIME, POSITIVE, "",
           "time between two rows of `measured.csv`; default: a hundredth of the duration"),
    {"sieves", FIELD_NUMBERS, UNIT_DIAMETER, offsetof(measure_def, sieves), 1, 100, false, "", 0, NO_WORDS,
     "feeds are cut into classes at these sieves, in any order; a particle as large as a sieve stays on it"},
    CHOICE(measure_def, series, "none|R5|R10|R20|R20/3|R40/3", "none",
           "the same at the sieves of a series of ISO 565 that cover all feeds"),
    {"by_class", FIELD_YES, UNIT_NONE, offsetof(measure_def, by_class), ANY, "no", 0, NO_WORDS,
     "columns of each class for every exit, `<exit>_<class>_kg`, and every region"},
    LIST(measure_def, regions, FIELD_NAMED, measured, 100, "", "regions with names"),
    PART(measure_def, separation, separation, "", 0, "into a fine and a coarse product"),
    LIST(measure_def, mixing, FIELD_NAMED, mixing, 20, "", "how well classes are mixed, with names"),
    LIST(measure_def, heaps, FIELD_NAMED, heap, 20, "", "heaps with names"),
};
SECTION(measure, measure_def, "measure",
        "`measured.csv` always has `time_s`, `particles`, `mass_kg`, `kinetic_J`, `largest_overlap` (of all contacts "
        "at that time, over the "
        "diameter of the smaller particle, of a clump's sphere, or of the sphere of a polyhedron's volume), of each "
        "class `left_<class>` "
        "(share of its fed mass that has "
        "passed no exit), of each exit `<exit>_kg`, `_kg_s` (flow) and `_residence_s` (time since they were fed, of "
        "those that passed), of each "
        "other wall `<wall>_Fx_N`, `_Fy_N`, `_Fz_N`; of one that turns `_torque_N_m`, of the particles about its axis; "
        "of one that moves `_power_W`, "
        "given to the particles; of all walls together `power_W` (flows, forces, torques, powers and residence times "
        "are means since the row "
        "before); `centre_x_m`, `centre_y_m`, `centre_z_m` of all particles' mass; with "
        "liquid `bridges`, `liquid_kg`; with polyhedra `core_overlaps`, pairs pressed deeper than their rounding: 0 is "
        "right, else contacts "
        "are "
        "too soft; with `law: bonds` `bonds`, the whole ones.");
static const scene_field output_fields[] = {
    NUMBER(output_def, frames, UNIT_TIME, POSITIVE, "",
           "time between two frames of the ParaView series `scene.pvd`, `scene_walls.pvd`; default: none"),
    NUMBER(output_def, tables, UNIT_TIME, POSITIVE, "",
           "time between two tables of all particles, `particles_0001.csv` and so on: id, place, velocity, spin, "
           "diameter, mass, group, "
           "contacts; default: none"),
    NUMBER(output_def, picture, UNIT_TIME, AT_LEAST_0, "", "time of `scene.png`; default: the end"),
    NUMBER(output_def, save, UNIT_TIME, POSITIVE, "",
           "time between two saves; there is always one at the end and after Ctrl-C"),
    CHOICE(output_def, colour, "class|speed", "class", "of the particles in pictures"),
    NUMBER(output_def, top_speed, UNIT_SPEED, POSITIVE, "1", "where the scale of speeds ends"),
    VECTOR(output_def, view, UNIT_NONE, "[0.3, 1, -0.4]", "viewing direction"),
    {"movie", FIELD_YES, UNIT_NONE, offsetof(output_def, movie), ANY, "no", 0, NO_WORDS, "`scene.mp4`, by ffmpeg"},
    {"movie_rate", FIELD_NUMBER, UNIT_NONE, offsetof(output_def, movie_rate), 1e-6, 1e3, false, "1", 0, NO_WORDS,
     "simulated seconds in a second of the movie"},
    TEXT(output_def, curves, "",
         "columns of `measured.csv` that `curves.svg` shows, a panel for each part between `;`: `left_*; kinetic_J, "
         "largest_overlap`; default: what "
         "is left of each class, and masses"),
    {"passed", FIELD_YES, UNIT_NONE, offsetof(output_def, passed), ANY, "no", 0, NO_WORDS,
     "`passed.csv`: a row for each particle that has passed an exit: time, exit, class, diameter, mass, residence "
     "time"},
};
SECTION(output, output_def, "output",
        "`scene.png` and `curves.svg` are always written; `--size 1920x1280` sets the size of the picture and of the "
        "movie.");
static const scene_field stop_fields[] = {
    TEXT(stop_def, column, MUST, "any column of `measured.csv`"),
    ONE_NUMBER(stop_def, below, FIELD_NUMBER, UNIT_NONE, ANY, 1, "stop when it is below this"),
    ONE_NUMBER(stop_def, above, FIELD_NUMBER, UNIT_NONE, ANY, 1, "stop when it is above this"),
    NUMBER(stop_def, after, UNIT_TIME, AT_LEAST_0, "0", "not before this time"),
};
SECTION(stop, stop_def, "stop condition",
        "Checked with each row of `measured.csv`; the first that holds ends the run.");

static const scene_field axis_fields[] = {
    NUMBER(axis_def, low, UNIT_LENGTH, ANY, MUST, "end"),
    NUMBER(axis_def, high, UNIT_LENGTH, ANY, MUST, "other end"),
};
SECTION(axis, axis_def, "periodic axis", "Longer than 2.2 of the largest diameters.");
static const scene_field periodic_fields[] = {
    {"x", FIELD_PART, UNIT_NONE, offsetof(periodic_def, axis) + 0 * sizeof(axis_def), ANY, "", 0, NULL, &axis_section,
     "along x"},
    {"y", FIELD_PART, UNIT_NONE, offsetof(periodic_def, axis) + 1 * sizeof(axis_def), ANY, "", 0, NULL, &axis_section,
     "along y"},
    {"z", FIELD_PART, UNIT_NONE, offsetof(periodic_def, axis) + 2 * sizeof(axis_def), ANY, "", 0, NULL, &axis_section,
     "along z"},
};
SECTION(periodic, periodic_def, "periodic", "Particles that leave at one end enter at the other.");

static const scene_field scene_fields[] = {
    TEXT(scene_def, title, "Scene", "of figures"),
    NUMBER(scene_def, duration, UNIT_TIME, POSITIVE, MUST, "simulated time"),
    NUMBER(scene_def, time_step, UNIT_TIME, POSITIVE, "",
           "default: as `dem_advise` proposes for the smallest particle that may come"),
    VECTOR(scene_def, gravity, UNIT_ACCELERATION, "[0, 0, -9.81]", "or inclined, for a machine that is"),
    {"seed", FIELD_WHOLE, UNIT_NONE, offsetof(scene_def, seed), 0.0, 9007199254740992.0, false, "1", 0, NO_WORDS,
     "of random places and sizes; `--seed` overrides it"},
    CHOICE(scene_def, law, "linear|hertz|epsd|epsd_hertz|dmt|jkr|bonds", "linear",
           "linear, hertz: friction and rolling resistance where a contact has them. epsd, epsd_hertz: these with a "
           "rolling "
           "spring that yields. dmt, jkr: hertz with adhesion, of stiff small and of soft large spheres. bonds: "
           "linear, with bonds "
           "that break. Equations: [contact_laws.md](contact_laws.md). The last five apply to spheres and clumps, "
           "bonds to spheres only"),
    NUMBER(scene_def, bond_at, UNIT_TIME, AT_LEAST_0, "",
           "`law: bonds`: time at which touching particles are bonded, if their contact has `bond`"),
    LIST(scene_def, materials, FIELD_NAMED, material, 8, MUST, "materials with names"),
    LIST(scene_def, contacts, FIELD_LIST, contact, 64, "", "pairs of materials"),
    LIST(scene_def, walls, FIELD_NAMED, wall, 32, "", "walls with names"),
    LIST(scene_def, shapes, FIELD_NAMED, shape, 32, "",
         "clumps, convex polyhedra and bodies of several of them, with names"),
    LIST(scene_def, feeds, FIELD_LIST, feed, 100, MUST, "sources of particles"),
    PART(scene_def, periodic, periodic, "", 0, "axes that close on themselves"),
    PART(scene_def, liquid, liquid, "", 0, "makes the scene wet"),
    PART(scene_def, measure, measure, "", 0, "what is measured"),
    PART(scene_def, output, output, "", 0, "pictures and files"),
    LIST(scene_def, stop, FIELD_LIST, stop, 100, "", "conditions to end before `duration`"),
};
const scene_table scene_section = {"scene", "The whole file.", scene_fields,
                                   (int)(sizeof scene_fields / sizeof *scene_fields), sizeof(scene_def)};

int scene_read(tree_file *file, scene_def *scene) {
    if (fields_read(file, file->root, &scene_section, scene)) return -1;
    for (int k = 0; k < scene->materials.n; k++)
        if (scene_fill_material(file, (material_def *)scene->materials.item + k)) return -1;
    /* what is not given has its defaults all the same */
    tree none = {TREE_MAP, 1, 1, NULL, 0, 0, 0, 0, NULL, NULL, NULL};
    const tree *measure = scene->measure.part.where, *output = scene->output.part.where;
    if (!measure && fields_read(file, &none, &measure_section, &scene->measure)) return -1;
    if (!output && fields_read(file, &none, &output_section, &scene->output)) return -1;
    scene->measure.part.where = measure, scene->output.part.where = output;
    if (scene->measure.sieves.n > 0 && scene->measure.series > 0)
        return tree_fail(file, fields_where(&scene->measure.part, "series"),
                         "series: sieves are given, too; one of both");
    if (!(scene->measure.every > 0.0)) scene->measure.every = scene->duration / 100.0;
    return 0;
}
