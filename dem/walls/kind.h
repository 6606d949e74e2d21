/* A kind of wall is one row of flags and functions, in a file of its own. The engine uses the row of a wall
   (wall->kind__), which the function that adds the wall sets, so that a program compiles only the kinds that it adds.
   walls/kinds.h lists all rows. Positions passed to these functions are relative to the wall's origin, along the
   world's axes. */
#pragma once
#include "../base/polyhedron.h"
#include "../base/vectors.h"

/* A place where a sphere is close to a wall. */
typedef struct dem__touch {
    double gap, curvature;
    dem_vec normal; /* from the wall to the sphere */
    int32_t element;
    int32_t face; /* mesh: the triangle with the nearest point inside its edges; -1: none */
} dem__touch;

enum {
    DEM__TOUCHES = 4, /* places of a wall that a sphere touches at most */
    DEM__NUMBERS = 16 /* contacts of a particle with a mesh at most, including those that end in this step */
};

/* An edge of a wall that edges of polyhedra can cross: a line, or a capsule about one. */
typedef struct dem__wall_edge {
    dem_vec from, to; /* [m] */
    double radius;    /* 0: sharp */
    int32_t key;
    int ends;     /* bits 0, 1: it begins, ends at a corner of the wall */
    int is_sided; /* 1: it protrudes along `outward` only; 0: it can be touched from all around */
    int is_axis;  /* 1: the axis of a bar, which no core may pass */
    double sign;  /* 1, -1: it is touched only where the normal is on this side of `side`; 0: everywhere */
    dem_vec outward, side;
} dem__wall_edge;

/* Receives the edges and corners of a wall. A corner is a ball about x. tip: its outward direction; 0: it can be
   touched from all sides. */
typedef struct dem__edge_visitor dem__edge_visitor;
struct dem__edge_visitor {
    void (*corner)(dem__edge_visitor *v, dem_vec x, double radius, dem_vec tip, int32_t key);
    void (*edge)(dem__edge_visitor *v, const dem__wall_edge *e);
};

/* Keys distinguish the points of a polyhedron at a wall. First come those of its corners, DEM_CORNERS_MAX for each
   place of the wall that has its own keys; then one for each corner of the wall, and DEM__EDGE_KEYS for each of its
   edges. */
enum {
    DEM__CROSSINGS_MAX = 4,                                       /* of an edge with a curved sheet, at most */
    DEM__EDGE_KEYS = 5 * DEM_EDGES_MAX,                           /* of an edge of a wall */
    DEM__SEARCH_KEYS = 3 * DEM__CROSSINGS_MAX * DEM_EDGES_MAX,    /* of a curved sheet */
    DEM__ELEMENT_KEYS = DEM_CORNERS_MAX + 2 + 3 * DEM__EDGE_KEYS, /* of a bar: all its keys */
    DEM__ELEMENTS_FROM = 1 << 18, /* added to the index of an element, which may be negative */
    DEM__PLACE_DIRECTIONS = 150   /* directions of normals at a mesh, as places of corners */
};

/* Flags of a kind. */
enum {
    DEM__NO_SURFACE = 1, /* nothing touches it: particles beyond it leave */
    DEM__HALF_SPACE = 2, /* a half space: dem__touch_flat finds where it is touched */
    DEM__CONVEX = 4,     /* seen from the particles' side, so that a gap shrinks fastest along its normal, but for
                            `closing` */
    DEM__KEEPS_CURVATURE = 8, /* a contact keeps the curvature with which it began */
    DEM__TRIANGULATED = 16,   /* made of the triangles in wall->tree: a contact keeps the place that it follows */
    DEM__CURVED_SHEET = 32    /* places where it touches the edges of a polyhedron must be searched along them */
};

/* How corners of a convex body tell its gap to a wall: another part may be nearer, none is, or they tell nothing. */
enum { DEM__CORNERS_SOME, DEM__CORNERS_ALL, DEM__CORNERS_NONE };

/* A kind of wall. Functions may be NULL where this is stated. */
typedef struct dem__wall_kind {
    int kind, flags;                    /* dem_wall_kind; DEM__HALF_SPACE and others */
    int (*is_sound)(const dem_wall *w); /* returns whether its lengths, from a file, are valid for such a wall */
    /* Finds the places where a sphere's gap is below `limit`, at most DEM__TOUCHES: gap, normal, and curvature and
       element if they are not 0. Returns how many. least: a lower limit of the gap. */
    int (*touch)(const dem_wall *w, dem_vec d, double radius, double limit, dem__touch *out, double *least);
    /* Walls with several elements, each of which is touched by itself: computes the touch at one of them, whose index
       is set, at any gap; returns a lower limit of the gap to those that `touch` does not return. NULL: one element. */
    void (*touch_element)(const dem_wall *w, dem_vec d, double radius, int32_t element, dem__touch *out);
    double (*other_elements)(const dem_wall *w, double radius, double lowest);
    /* Round walls: computes the vector from the axis or centre to the sphere's centre, and how far from there the
       surface is. Returns 1 if the sphere is outside, -1 if inside, 0 if the place is not round or has no normal. */
    double (*reach_round)(const dem_wall *w, dem_vec d, int32_t element, dem_vec *from, double *inner);
    /* Returns the rate of change of the normal n [1/s] for a sphere that moves at u in the wall's own frame. inverse: 1
       / distance from the axis of a round wall, with the sign of the side. NULL: 0. */
    dem_vec (*normal_rate)(const dem_wall *w, dem_vec d, double radius, int32_t element, dem_vec n, double inverse,
                           dem_vec u);
    /* returns whether it continues unchanged along an axis of the world */
    int (*is_endless)(const dem_wall *w, int axis);
    /* Returns a limit of the acceleration with which the gap of a place shrinks for a sphere in free fall, at u [m/s]
       from the wall. NULL: the acceleration of gravity and of the wall. */
    double (*closing)(const dem_wall *w, const dem__touch *touch, double radius, dem_vec gravity, dem_vec u);
    /* For polyhedra. */
    int (*corners)(const dem_wall *w); /* returns DEM__CORNERS_.. */
    /* Presents the edges and corners that may be within `reach` of a centre to a visitor, relative to that centre. */
    void (*edges)(const dem_wall *w, dem_vec centre, double reach, dem__edge_visitor *v);
    int (*crosses)(const dem_wall *w, dem_vec p, dem_vec q); /* sheet: returns whether the line from p to q cuts it */
} dem__wall_kind;

/* Returns whether the kind of a wall has one of some flags. */
DEM_INLINE int dem__has(const dem_wall *w, int flags) { return (w->kind__->flags & flags) != 0; }
DEM_INLINE int dem__has_surface(const dem_wall *w) { return !dem__has(w, DEM__NO_SURFACE); }
/* Returns whether a wall has several elements, each of which is touched by itself. */
DEM_INLINE int dem__has_elements(const dem_wall *w) { return w->kind__->touch_element != NULL; }

/* Returns whether a wall acts on particles of a group. */
DEM_INLINE int dem__acts_on(const dem_wall *w, int32_t group) {
    return (int)(w->groups >> (group >= 0 && group < 31 ? group : 31) & 1u);
}
/* Returns whether a wall is enabled and acts on particle i. */
DEM_INLINE int dem__is_at_wall(const dem_world *w, ptrdiff_t i, int wall) {
    return w->wall[wall].enabled && dem__acts_on(&w->wall[wall], w->group[i]);
}

/* Transforms a vector to a wall's own frame, and back. */
DEM_INLINE dem_vec dem__to_frame(const dem_wall *w, dem_vec d) {
    return dem_vec3(dem__dot(d, w->axis[0]), dem__dot(d, w->axis[1]), dem__dot(d, w->axis[2]));
}
DEM_INLINE dem_vec dem__from_frame(const dem_wall *w, dem_vec v) {
    return dem__add(dem__add(dem__scale(v.x, w->axis[0]), dem__scale(v.y, w->axis[1])), dem__scale(v.z, w->axis[2]));
}

DEM_INLINE void dem__touch_flat(const dem_wall *w, dem_vec d, double radius, dem__touch *out) {
    out->element = 0;
    out->gap = dem__dot(d, w->axis[2]) - radius;
    out->normal = w->axis[2], out->curvature = 0.0;
}

/* Finds all places where a sphere's gap to a wall is below limit (at most DEM__TOUCHES; of a mesh the nearest one and
   those that overlap). Returns how many. least: a lower limit of the gap. */
DEM_INLINE int dem__touch_wall(const dem_wall *w, dem_vec centre, double radius, double limit, dem__touch *out,
                               double *least) {
    out[0].element = 0;
    out[0].curvature = 0.0;
    return w->kind__->touch(w, dem__sub(centre, w->position), radius, limit, out, least);
}

/* Finds the one place where an element of a wall is touched, at any gap. */
static inline void dem__touch_element(const dem_wall *w, dem_vec centre, double radius, int32_t element,
                                      dem__touch *out) {
    double least;
    if (dem__has_elements(w)) {
        w->kind__->touch_element(w, dem__sub(centre, w->position), radius, element, out);
        return;
    }
    dem__touch touch[DEM__TOUCHES]; /* a mesh can be touched in several places */
    touch[0].gap = HUGE_VAL, touch[0].normal = w->axis[2];
    dem__touch_wall(w, centre, radius, HUGE_VAL, touch, &least);
    *out = touch[0];
}

/* As dem__wall_kind.reach_round; 0 if the wall is not round. */
DEM_INLINE double dem__reach_round(const dem_wall *w, dem_vec centre, int32_t element, dem_vec *from, double *inner) {
    return w->kind__->reach_round ? w->kind__->reach_round(w, dem__sub(centre, w->position), element, from, inner)
                                  : 0.0;
}
/* As dem__wall_kind.normal_rate. */
DEM_INLINE dem_vec dem__normal_rate(const dem_wall *w, dem_vec centre, double radius, int32_t element, dem_vec n,
                                    double inverse, dem_vec u) {
    return w->kind__->normal_rate
               ? w->kind__->normal_rate(w, dem__sub(centre, w->position), radius, element, n, inverse, u)
               : dem_vec3(0.0, 0.0, 0.0);
}

/* Returns whether a wall's surface runs around pulleys. */
DEM_INLINE int dem__turns_as_belt(const dem_wall *w) {
    return w->asked.belt_turn.x != 0.0 || w->asked.belt_turn.y != 0.0 || w->asked.belt_turn.z != 0.0;
}
DEM_INLINE int dem__is_belt(const dem_wall *w) {
    return w->asked.belt.x != 0.0 || w->asked.belt.y != 0.0 || w->asked.belt.z != 0.0 || dem__turns_as_belt(w);
}
/* Returns the velocity of a wall's surface within itself where the normal is n. */
DEM_INLINE dem_vec dem__belt_velocity(const dem_wall *w, dem_vec n) {
    const dem_vec along = dem__sub(w->asked.belt, dem__scale(dem__dot(w->asked.belt, n), n));
    return dem__turns_as_belt(w) ? dem__add(along, dem__cross(w->asked.belt_turn, n)) : along;
}
/* Returns the velocity of a wall's surface at a point whose normal is n. */
DEM_INLINE dem_vec dem__surface_velocity(const dem_wall *w, dem_vec point, dem_vec n) {
    const dem_vec turning = dem__cross(dem__scale(w->spin, w->spin_axis), dem__sub(point, w->position));
    return dem__add(dem__add(w->velocity, turning), dem__belt_velocity(w, n));
}
/* Adds what a push of duration h transfers to a wall: the integrals of its force and of its torque about its origin,
   and the work that the wall does meanwhile. belt_power: of its belt. */
DEM_INLINE void dem__book_push(dem_wall *w, double h, dem_vec force, dem_vec torque, double belt_power) {
    const dem_vec spin = dem__scale(w->spin, w->spin_axis);
    w->impulse = dem__plus(w->impulse, h, force);
    w->angular_impulse = dem__plus(w->angular_impulse, h, dem__add(torque, dem__cross(w->position, force)));
    w->work += h * (belt_power - dem__dot(force, w->velocity) - dem__dot(torque, spin));
}
/* Returns the acceleration of a wall's surface at a point. */
DEM_INLINE dem_vec dem__surface_acceleration(const dem_wall *w, dem_vec point) {
    const dem_vec omega = dem__scale(w->spin, w->spin_axis), arm = dem__sub(point, w->position);
    const dem_vec inward = dem__cross(omega, dem__cross(omega, arm));
    return dem__add(w->acceleration, dem__add(inward, dem__scale(w->spin_rate, dem__cross(w->spin_axis, arm))));
}
