/* Compounds: bodies of several convex parts. Reads shapes; adds copies of them and bodies to a world. Promises: a
   compound of one part moves as the polyhedron itself; a face that several parts make is one contact (see
   compound_pairs.h), of one to two times the stiffness of the pair. */
#pragma once
#include "../bodies/clump_shape.h"
#include "../bodies/clumps.h"
#include "../bodies/getters.h"
#include "add.h"

#define DEM__SAME_FACE 0.1 /* distance of the planes of two faces that make one, over the rounding radius */

/* A compound while it is made: its parts, along its principal axes, about its centre of mass. */
typedef struct dem__builder {
    int n;
    const dem_convex *part;            /* [n] */
    dem_quaternion own[DEM_PARTS_MAX]; /* from a part's planes and corners to the body's given frame */
    dem_vec place[DEM_PARTS_MAX];      /* of its centroid, in that frame [m] */
    dem_convex body;                   /* volume, moments and rate of the whole */
} dem__builder;

/* Returns where a corner or a plane's normal of a part points, in the frame in which the compound is given. */
static inline dem_vec dem__of_part(const dem__builder *b, int k, const double *v) {
    return dem__to_lab(b->own[k], dem__point(v));
}

/* Returns whether the centroid of part k lies in part o. */
static inline int dem__is_inside_part(const dem__builder *b, int k, int o) {
    const dem_convex *s = &b->part[o];
    const dem_vec x = dem__to_body(b->own[o], dem__sub(b->place[k], b->place[o]));
    for (int f = 0; f < s->faces; f++) {
        if (!(dem__dot(dem__point(s->plane[f]), x) < s->plane[f][3])) return 0;
    }
    return 1;
}

/* Returns whether faces f of part k and g of part o lie in one plane and look to the same side. */
static inline int dem__make_one_face(const dem__builder *b, int k, int f, int o, int g) {
    const dem_convex *s = &b->part[k], *t = &b->part[o];
    if (k == o) return f == g;
    const dem_vec n = dem__of_part(b, k, s->plane[f]);
    if (!(dem__dot(n, dem__of_part(b, o, t->plane[g])) > 1.0 - 1e-6)) return 0;
    const double here = dem__dot(n, b->place[k]) + s->plane[f][3] + s->radius,
                 there = dem__dot(n, b->place[o]) + t->plane[g][3] + t->radius;
    return fabs(here - there) <= DEM__SAME_FACE * (s->radius < t->radius ? s->radius : t->radius);
}

/* Adds the corners of face g of part o to the modes of a face with a normal along the principal axes. at: the body's
   centre of mass; axes: the principal axes. Returns the sum of their springs. */
static inline double dem__add_face_modes(const dem__builder *b, int o, int g, dem_vec at, dem_quaternion axes,
                                         dem_vec normal, dem__modes *m) {
    const dem_convex *s = &b->part[o], *body = &b->body;
    for (int k = s->face_start[g]; k < s->face_start[g + 1]; k++) {
        const dem_vec x = dem__add(b->place[o], dem__of_part(b, o, s->corner[s->face_corner[k]]));
        const dem_vec arm = dem__cross(dem__to_body(axes, dem__sub(x, at)), normal);
        double u[4] = {1.0, 0.0, 0.0, 0.0};
        for (int a = 0; a < 3; a++) u[1 + a] = dem_axis(arm, a) * sqrt(body->volume / body->moment[a]);
        dem__add_spring(m, dem__part_of(s), u);
    }
    return (double)(s->face_start[g + 1] - s->face_start[g]) * dem__part_of(s);
}

/* Sets the highest rate of a contact of a compound: of a corner, or of a face that some parts make together. */
static inline void dem__find_body_rate(dem__builder *b, dem_vec at, dem_quaternion axes) {
    b->body.rate = 1.0;
    for (int k = 0; k < b->n; k++) {
        const dem_convex *s = &b->part[k];
        for (int f = 0; f < s->faces; f++) {
            const dem_vec normal = dem__to_body(axes, dem__of_part(b, k, s->plane[f]));
            double springs = 0.0;
            dem__modes m;
            memset(&m, 0, sizeof m);
            for (int o = 0; o < b->n; o++) {
                for (int g = 0; g < b->part[o].faces; g++) {
                    if (dem__make_one_face(b, k, f, o, g))
                        springs += dem__add_face_modes(b, o, g, at, axes, normal, &m);
                }
            }
            const double rate = dem__highest_rate(&m, 5) / dem__divide(springs).by;
            b->body.rate = rate > b->body.rate ? rate : b->body.rate;
        }
        b->body.springs = s->springs;
        for (int c = 0; c < s->corners; c++) {
            const dem_vec x = dem__add(b->place[k], dem__of_part(b, k, s->corner[c]));
            const double rate = dem__rate_of_corner(&b->body, dem__to_body(axes, dem__sub(x, at)));
            b->body.rate = rate > b->body.rate ? rate : b->body.rate;
        }
    }
}

/* Places the parts of a compound. Returns NULL, or what is wrong. */
static inline const char *dem__place_parts(dem__builder *b, const double *places, const double *orientations,
                                           dem_compound *c) {
    for (int k = 0; k < b->n; k++) {
        const dem_convex *s = &b->part[k];
        const double *o = orientations ? orientations + 4 * k : NULL;
        c->turn[k] = dem__quaternion(1.0, dem_vec3(0.0, 0.0, 0.0));
        if (!dem__is_sound_shape(s) || !dem__are_axes(s->axis)) return "a part is no polyhedron";
        if (o && !dem__unit_turn(dem__quaternion(o[0], dem_vec3(o[1], o[2], o[3])), &c->turn[k]))
            return "an orientation has no direction";
        b->own[k] = s->along_axes ? dem__turns(c->turn[k], dem__turn_of_shape(s)) : c->turn[k];
        b->place[k] = dem__to_lab(c->turn[k], s->centroid);
        if (places) b->place[k] = dem__add(dem__point(places + 3 * k), b->place[k]);
        if (!dem__finite_vec(b->place[k])) return "a place is not finite";
        for (int o2 = 0; o2 < k; o2++) {
            if (dem__is_inside_part(b, k, o2) || dem__is_inside_part(b, o2, k))
                return "the centroid of a part lies in another part";
        }
    }
    return NULL;
}

/* Sums volume, centre of mass and moments of the parts. */
static inline void dem__sum_parts(dem__builder *b, dem_compound *c) {
    double t[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    int order[3];
    c->volume = 0.0;
    dem_vec first = dem_vec3(0.0, 0.0, 0.0);
    for (int k = 0; k < b->n; k++) {
        c->volume += b->part[k].volume;
        first = dem__plus(first, b->part[k].volume, dem__sub(b->place[k], b->place[0]));
    }
    c->origin = dem__plus(b->place[0], 1.0 / c->volume, first);
    for (int k = 0; k < b->n; k++) {
        const dem_convex *s = &b->part[k];
        const dem_vec d = dem__sub(b->place[k], c->origin);
        const double v = s->volume;
        c->centre[k] = d;
        t[0] += v * (d.y * d.y + d.z * d.z), t[1] += v * (d.z * d.z + d.x * d.x), t[2] += v * (d.x * d.x + d.y * d.y);
        t[3] -= v * d.x * d.y, t[4] -= v * d.y * d.z, t[5] -= v * d.z * d.x;
        for (int a = 0; a < 3; a++) {
            const dem_vec u = dem__to_lab(c->turn[k], s->axis[a]);
            const double m = s->moment[a];
            t[0] += m * u.x * u.x, t[1] += m * u.y * u.y, t[2] += m * u.z * u.z;
            t[3] += m * u.x * u.y, t[4] += m * u.y * u.z, t[5] += m * u.z * u.x;
        }
    }
    c->moments = dem__clump_axes(t, &c->axes);
    dem__merge_moments(&c->moments, 1e-12);
    dem__order_moments(&c->moments, &c->axes, order);
}

/* Adds the parts of a compound to the shapes of a world, with the rate of the whole. */
static inline dem_status dem__add_part_shapes(dem_world *w, const dem__builder *b, dem_compound *c) {
    for (int k = 0; k < b->n; k++) {
        dem_convex own = b->part[k];
        own.rate = b->body.rate;
        c->shape[k] = dem_add_shape(w, &own);
        if (c->shape[k] < 0) return (dem_status)-c->shape[k];
    }
    return DEM_OK;
}

DEM_API dem_status dem_make_compound(dem_world *world, int n, const dem_convex *parts, const double *places,
                                     const double *orientations, dem_compound *compound, const char **reason) {
    dem__builder b;
    dem_compound c;
    if (reason) *reason = NULL;
    if (dem__is_running(world)) return DEM_BUSY;
    if (dem__lacks_memory(world)) return DEM_BAD_ARGUMENT;
    if (n < 1) return dem__refuse(world, "n: below 1");
    if (!parts) return dem__refuse(world, "parts: NULL");
    if (!compound) return dem__refuse(world, "compound: NULL");
    if (n > DEM_PARTS_MAX) return DEM_TOO_MANY;
    memset(&b, 0, sizeof b), memset(&c, 0, sizeof c);
    b.n = c.parts = n, b.part = parts, c.add__ = dem_add_compounds;
    const char *wrong = dem__place_parts(&b, places, orientations, &c);
    if (!wrong) {
        dem__sum_parts(&b, &c);
        if (!dem__positive(c.volume) || !dem__are_moments(c.moments)) wrong = "mass or moments are not positive";
    }
    if (reason) *reason = wrong;
    if (wrong) return dem__refuse(world, wrong);
    b.body.volume = c.volume;
    for (int a = 0; a < 3; a++) b.body.moment[a] = dem_axis(c.moments, a);
    dem__find_body_rate(&b, c.origin, c.axes);
    const dem_status status = dem__add_part_shapes(world, &b, &c);
    if (status == DEM_OK) *compound = c;
    return status;
}

/* Adds one compound, for which there is room. */
static inline void dem__put_compound(dem_world *w, const dem_compound *c, const dem__body_def *def) {
    dem__convex_state *convex = &w->engine->convex;
    const ptrdiff_t first = dem__add_body(w, def);
    const dem_quaternion axes = dem__rigid_of(w, first)->frame;
    convex->has_parts = 1;
    for (int k = 0; k < c->parts; k++) {
        dem_quaternion turn = c->turn[k];
        dem__unit_turn(turn, &turn);
        turn = dem__turns(turn, dem__turn_of_shape(&convex->shape[c->shape[k]]));
        convex->shape_of[first + k] = c->shape[k] + 1;
        convex->part[first + k] = dem__kept_unit(dem__turns(dem__opposite_turn(axes), turn));
    }
}

DEM_API dem_status dem_add_compounds(dem_world *world, ptrdiff_t n, const dem_compound *compound, const double *centres,
                                     const double *orientations, int material, int group) {
    dem_world *w = world;
    const dem_compound *c = compound;
    dem_vec offset[DEM_PARTS_MAX];
    double radius[DEM_PARTS_MAX];
    dem__body_def def;
    if (dem__is_running(w)) return DEM_BUSY;
    if (dem__lacks_material(w, material)) return DEM_BAD_ARGUMENT;
    if (n < 0) return dem__refuse(w, "n: below 0");
    if (n > 0 && !centres) return dem__refuse(w, "centres: NULL");
    if (!dem__is_compound(w, c))
        return dem__refuse(w, "compound: NULL, or not one that dem_make_compound made in this world");
    if (!dem__are_turns(n, orientations)) return dem__refuse(w, "orientations: a quaternion is 0 or not finite");
    if (n > (INT32_MAX / 4 - w->count) / c->parts) return DEM_TOO_MANY;
    for (ptrdiff_t k = 0; k < 3 * n; k++) {
        if (!dem__finite(centres[k])) return dem__refuse(w, "centres: a coordinate is not finite");
    }
    const double density = w->def.material[material].density;
    memset(&def, 0, sizeof def);
    dem__unit_turn(c->axes, &def.frame);
    for (int k = 0; k < c->parts; k++)
        offset[k] = dem__to_body(def.frame, c->centre[k]), radius[k] = w->engine->convex.shape[c->shape[k]].reach;
    def.mass = density * c->volume, def.moments = dem__scale(density, c->moments);
    def.pieces = c->parts, def.offset = offset, def.radius = radius, def.material = material, def.group = group;
    if (!dem__is_body_def(&def)) return dem__refuse(w, "compound: mass or inertia of a body is not a normal number");
    if (!dem__reserve_bodies(w, n, n * c->parts)) return DEM_OUT_OF_MEMORY;
    for (ptrdiff_t k = 0; k < n; k++) {
        const double *o = orientations ? orientations + 4 * k : NULL;
        def.x = dem__point(centres + 3 * k), def.turn = dem__quaternion(1.0, dem_vec3(0.0, 0.0, 0.0));
        if (o) dem__unit_turn(dem__quaternion(o[0], dem_vec3(o[1], o[2], o[3])), &def.turn);
        dem__put_compound(w, c, &def);
    }
    return DEM_OK;
}

DEM_API dem_quaternion dem_shape_orientation(const dem_world *world, ptrdiff_t i) {
    if (!world || i < 0 || i >= world->count || !dem__is_part(world, i)) return dem_orientation(world, i);
    return dem__turns(dem__turn_of_polyhedron(world, i, dem__body_turn_at(world, i, dem__now(world, i))),
                      dem__opposite_turn(dem__turn_of_shape(dem__shape_of(world, i))));
}
