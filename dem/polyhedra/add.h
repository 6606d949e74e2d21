/* Adding shapes and polyhedra to a world, and the table of functions that the engine then calls for them
   (dem__convex_calls). Reads shapes; writes the world through dem__add_body. */
#pragma once
#include "../bodies/rigid.h"
#include "pairs.h"
#include "block.h"

static inline const dem__convex_calls *dem__polyhedra(void) {
    static const dem__convex_calls row = {dem__list_convex_pairs, dem__follow_polyhedra,   dem__prepare_convex,
                                                     dem__fill_convex_rows,  dem__finish_convex_rows, dem_add_convex,
                                                     dem__leave_convex_edges};
    return &row;
}

/* Returns whether the tables of a shape agree with each other, and its numbers are such as the code relies on. */
static inline int dem__is_sound_shape(const dem_convex *c) {
    if (c->corners < 4 || c->corners > DEM_CORNERS_MAX || c->edges < 6 || c->edges > DEM_EDGES_MAX || c->faces < 4 ||
        c->faces > DEM_FACES_MAX)
        return 0;
    int sound = dem__positive(c->radius) && dem__positive(c->reach) && dem__positive(c->volume) && c->share > 0.0 &&
                c->share <= 1.0 && c->face_start[0] == 0 && c->face_start[c->faces] == 2 * c->edges;
    for (int k = 0; k < 3; k++) sound &= dem__positive(c->moment[k]);
    for (int k = 0; k < 3 * c->corners; k++) sound &= fabs(c->corner[k / 3][k % 3]) <= c->reach;
    for (int k = 0; k < 4 * c->faces; k++) sound &= fabs(c->plane[k / 4][k % 4]) <= (k % 4 < 3 ? 1.0 + 1e-9 : c->reach);
    for (int k = 0; k < c->faces; k++) sound &= c->face_start[k] < c->face_start[k + 1];
    for (int k = 0; k < 2 * c->edges; k++) {
        sound &= c->face_corner[k] < c->corners && c->edge[k / 2][k % 2] < c->corners &&
                 c->edge_face[k / 2][k % 2] < c->faces;
    }
    return sound;
}

DEM_API int dem_add_shape(dem_world *world, const dem_convex *shape) {
    dem_world *w = world;
    if (!w || !w->def.allocator.fn || !shape || !dem__is_sound_shape(shape)) return -(int)DEM_BAD_ARGUMENT;
    if (dem__is_running(w)) return -(int)DEM_BUSY;
    dem__convex_state *convex = &w->engine->convex;
    const dem_allocator *a = &w->def.allocator;
    dem__array list[DEM__ARRAYS_MAX];
    const size_t size = sizeof *convex->shape, old = (size_t)convex->shapes * size;
    if (convex->shapes == 0 && !dem__make_touch_memory(w)) return -(int)DEM_OUT_OF_MEMORY;
    dem_convex *fresh = (dem_convex *)a->fn(a->user, convex->shape, old, old + size);
    if (!fresh) return -(int)DEM_OUT_OF_MEMORY;
    convex->shape = fresh, convex->calls = dem__polyhedra();
    convex->shape[convex->shapes++] = *shape;
    if (convex->shapes > 1) return convex->shapes - 1;
    dem__bodies *bodies = &w->engine->bodies;
    if (dem__grow_group(w, list, dem__particle_arrays(w, list), &bodies->block, &bodies->bytes, &bodies->capacity,
                        w->count + 1))
        return 0;
    dem__release(a, convex->shape, size);
    convex->shape = NULL, convex->shapes = 0, convex->calls = NULL;
    return -(int)DEM_OUT_OF_MEMORY;
}

/* Returns whether n orientations are quaternions with a direction. */
static inline int dem__are_turns(ptrdiff_t n, const double *orientations) {
    dem_quaternion q;
    for (ptrdiff_t k = 0; k < n && orientations; k++) {
        const double *o = orientations + 4 * k;
        if (!dem__unit_turn(dem__quaternion(o[0], dem_vec3(o[1], o[2], o[3])), &q)) return 0;
    }
    return 1;
}

DEM_API dem_status dem_add_convex(dem_world *world, int shape, ptrdiff_t n, const double *centres,
                                  const double *orientations, int material, int group) {
    dem_world *w = world;
    if (dem__is_running(w)) return DEM_BUSY;
    if (!w || !w->def.allocator.fn || n < 0 || (n > 0 && !centres) || material < 0 || material >= w->def.materials ||
        shape < 0 || shape >= w->engine->convex.shapes)
        return DEM_BAD_ARGUMENT;
    if (n > INT32_MAX / 4 - w->count) return DEM_TOO_MANY;
    const dem_convex *s = &w->engine->convex.shape[shape];
    const double density = w->def.material[material].density;
    const dem_vec none = dem_vec3(0.0, 0.0, 0.0);
    for (ptrdiff_t k = 0; k < 3 * n; k++) {
        if (!dem__finite(centres[k])) return DEM_BAD_ARGUMENT;
    }
    if (!dem__are_turns(n, orientations) || !dem__positive(density * s->moment[0] * s->moment[1]))
        return DEM_BAD_ARGUMENT;
    if (!dem__reserve_bodies(w, n, n)) return DEM_OUT_OF_MEMORY;
    dem__body_def body;
    memset(&body, 0, sizeof body);
    body.mass = density * s->volume, body.moments = dem__scale(density, dem__point(s->moment));
    body.frame = dem__quaternion(1.0, none);
    const dem_quaternion own = dem__turn_of_shape(s);
    body.pieces = 1, body.offset = &none, body.radius = &s->reach, body.material = material, body.group = group;
    for (ptrdiff_t k = 0; k < n; k++) {
        const double *o = orientations ? orientations + 4 * k : NULL;
        body.x = dem__point(centres + 3 * k);
        body.turn = own;
        if (o) {
            dem__unit_turn(dem__quaternion(o[0], dem_vec3(o[1], o[2], o[3])), &body.turn);
            if (own.w != 1.0) body.turn = dem__turns(body.turn, own);
        }
        w->engine->convex.shape_of[dem__add_body(w, &body)] = shape + 1;
    }
    return DEM_OK;
}

DEM_API int dem_shape_of(const dem_world *world, ptrdiff_t i) {
    if (!world || !world->engine || i < 0 || i >= world->count || world->engine->convex.shapes == 0) return -1;
    return world->engine->convex.shape_of[i] - 1;
}
DEM_API const dem_convex *dem_get_shape(const dem_world *world, int shape) {
    return world && world->engine && shape >= 0 && shape < world->engine->convex.shapes
               ? &world->engine->convex.shape[shape]
               : NULL;
}
/* Returns whether a wall cuts the core of the particle that it is listed with, in the last step. */
static inline int dem__is_cut(const dem_world *w, const dem__convex_pair *p) {
    const dem__convex_state *convex = &w->engine->convex;
    const dem_convex *s = p->i < w->count && w->alive[p->i] == DEM_PRESENT ? dem__shape_of(w, p->i) : NULL;
    if (!s || !p->is_close) return 0;
    for (int32_t k = p->first; k < p->first + p->count; k++) {
        if (convex->point[k].gap < -s->radius) return 1;
    }
    return dem__core_passes(&w->wall[-1 - p->j], s, &convex->place[p->i]);
}
DEM_API int64_t dem_core_overlaps(const dem_world *world) {
    const dem__convex_state *convex = world && world->engine ? &world->engine->convex : NULL;
    int64_t n = convex ? convex->overlaps : 0;
    for (ptrdiff_t q = convex ? convex->of_particles : 0; convex && q < convex->pairs; q++)
        n += dem__is_cut(world, &convex->pair[q]);
    return n;
}
