/* Adding shapes and polyhedra to a world, and the table of functions that the engine then calls for them
   (dem__convex_calls). Reads shapes; writes the world through dem__add_body. */
#pragma once
#include "../bodies/add.h"
#include "save.h"
#include "pairs.h"
#include "block.h"
#include "ready.h"

static inline const dem__convex_calls *dem__polyhedra(void) {
    static const dem__convex_calls row = {dem__prepare_convex, dem__fill_convex_rows, dem__finish_convex_rows,
                                          dem_add_convex, dem__exclude_convex};
    return &row;
}

/* Returns whether the tables of a shape agree with each other, and its numbers are in the ranges that the code relies
   on. */
static inline int dem__is_sound_shape(const dem_convex *c) {
    if (c->corners < 4 || c->corners > DEM_CORNERS_MAX || c->edges < 6 || c->edges > DEM_EDGES_MAX || c->faces < 4 ||
        c->faces > DEM_FACES_MAX)
        return 0;
    int sound = c->deviation >= 0.0 && c->deviation <= DBL_MAX && dem__positive(c->radius) && dem__positive(c->reach) &&
                dem__positive(c->volume) && dem__positive(c->rate) && c->springs > 0 && c->face_start[0] == 0 &&
                c->face_start[c->faces] == 2 * c->edges;
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

/* ---- the feature ---- */

static inline int dem__list_arrays_of_polyhedra(dem_world *w, dem__array *list) {
    dem__convex_state *convex = &w->engine->convex;
    const dem__array arrays[] = {{&convex->shape_of, sizeof *convex->shape_of},
                                 {&convex->part, sizeof *convex->part},
                                 {&convex->place, sizeof *convex->place}};
    memcpy(list, arrays, sizeof arrays);
    return (int)(sizeof arrays / sizeof *arrays);
}

static inline void dem__release_polyhedra(dem_world *w) {
    const dem__convex_state *convex = &w->engine->convex;
    const dem_allocator *a = &w->def.allocator;
    dem__release(a, convex->shape, (size_t)convex->shapes * sizeof *convex->shape);
    dem__release_pairs(w);
    dem__release(a, convex->point, (size_t)convex->point_capacity * sizeof *convex->point);
}

/* A polyhedron that has been removed may have had this entry. */
static inline void dem__add_shapeless(dem_world *w, ptrdiff_t i) {
    w->engine->convex.shape_of[i] = 0;
    memset(&w->engine->convex.part[i], 0, sizeof w->engine->convex.part[i]);
}

/* Refuses kernels without friction, which compute no torques. */
static inline dem_status dem__check_polyhedra(const dem_world *w, const dem_kernel *kernel) {
    (void)w;
    return kernel->features & DEM_FRICTION ? DEM_OK : DEM_POLYHEDRON;
}

static inline dem_status dem__relist_polyhedra(dem_world *w) {
    return dem__list_convex_pairs(w) ? DEM_OK : DEM_OUT_OF_MEMORY;
}

static inline void dem__world_fields_of_polyhedra(dem_world *w, dem__group *g) {
    const dem__saved_field fields[] = {DEM__INTEGER("convex.overlap_steps", w->engine->convex.overlap_steps, 0)};
    dem__add_optional(g, fields, sizeof fields);
}
static inline void dem__particle_fields_of_polyhedra(dem_world *w, dem__group *g) {
    dem__convex_state *convex = &w->engine->convex;
    const dem__saved_field shape[] = {DEM__INTEGER("particle.shape", convex->shape_of[0], sizeof(int32_t)),
                                      DEM__DOUBLES("particle.part", convex->part[0], sizeof *convex->part)};
    dem__add_optional(g, shape, sizeof shape);
}

static inline void dem__save_shapes(dem__stream *s, dem_world *w, dem__group *g) {
    g->needed = g->fields = dem__shape_fields(w->engine->convex.shape, g->field);
    dem__write_group(s, w, g, w->engine->convex.shapes, 0);
}

static inline int dem__has_shapes(const dem__file *file, const dem_world *w) {
    (void)w;
    return dem__entries_of(file, "shape.corners") > 0;
}

/* Reads the shapes of polyhedra. */
static inline dem_status dem__load_shapes(const dem__file *file, dem_world *w, dem__group *g) {
    dem__convex_state *convex = &w->engine->convex;
    const ptrdiff_t n = dem__entries_of(file, "shape.corners");
    convex->shape =
        (dem_convex *)w->def.allocator.fn(w->def.allocator.user, NULL, 0, (size_t)n * sizeof *convex->shape);
    if (!convex->shape) return DEM_OUT_OF_MEMORY;
    memset(convex->shape, 0, (size_t)n * sizeof *convex->shape);
    convex->shapes = (int)n, convex->calls = dem__polyhedra();
    w->engine->walls.touch_keepers++;
    g->fields = dem__shape_fields(convex->shape, g->field), g->needed = g->fields - DEM__SHAPE_OPTIONAL;
    if (!dem__read_group(file, g, n)) return DEM_BAD_DATA;
    for (ptrdiff_t k = 0; k < n; k++) {
        convex->shape[k].along_axes = 1;
        if (!dem__is_sound_shape(&convex->shape[k])) return DEM_BAD_DATA;
    }
    return DEM_OK;
}

/* Checks the bodies whose shapes are polyhedra. Rigid bodies are loaded before them. */
static inline dem_status dem__load_polyhedra(const dem__file *file, dem_world *w, dem__group *g) {
    dem__convex_state *convex = &w->engine->convex;
    const dem_quaternion none = dem__quaternion(0.0, dem_vec3(0.0, 0.0, 0.0));
    (void)file, (void)g;
    for (ptrdiff_t i = 0; i < w->count; i++) convex->has_parts |= memcmp(&convex->part[i], &none, sizeof none) != 0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem__rigid *r = dem__rigid_of(w, i);
        const dem_quaternion q = convex->part[i];
        const int is_part = dem__is_part(w, i);
        if (is_part && !(fabs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1.0) < 1e-6)) return DEM_BAD_DATA;
        if (r && is_part != dem__is_part(w, r->first)) return DEM_BAD_DATA;
        if (convex->shape_of[i] == 0 && !is_part) continue;
        if (convex->shape_of[i] <= 0 || convex->shape_of[i] > convex->shapes || !r || (r->pieces != 1 && !is_part))
            return DEM_BAD_DATA;
    }
    return DEM_OK;
}

/* Where there are shapes, saves keep no faces that spheres have found at meshes: none is trusted. */
static inline void dem__forget_faces(dem_world *w) {
    const dem__contacts *contacts = &w->engine->contacts;
    DEM__EACH_CONTACT(w, c) {
        if (contacts->j[c] < 0 && !dem__shape_of(w, contacts->i[c])) contacts->touch[DEM__PLACE_SLACK][c] = 0.0;
    }
}

static inline dem__feature dem__feature_polyhedra(void) {
    dem__feature f = dem__new_feature(DEM__POLYHEDRA_FEATURE);
    f.list_arrays = dem__list_arrays_of_polyhedra;
    f.release = dem__release_polyhedra;
    f.add_particle = dem__add_shapeless;
    f.check_run = dem__check_polyhedra;
    f.listed = dem__relist_polyhedra;
    f.detect = dem__follow_polyhedra;
    f.world_fields = dem__world_fields_of_polyhedra;
    f.particle_fields = dem__particle_fields_of_polyhedra;
    f.save = dem__save_shapes;
    f.is_used = dem__has_shapes;
    f.load_first = dem__load_shapes;
    f.load = dem__load_polyhedra;
    f.loaded = dem__forget_faces;
    return f;
}

DEM_API int dem_add_shape(dem_world *world, const dem_convex *shape) {
    dem_world *w = world;
    if (dem__lacks_memory(w)) return -(int)DEM_BAD_ARGUMENT;
    if (!shape || !dem__is_sound_shape(shape) || !dem__are_axes(shape->axis))
        return -(int)dem__refuse(w, "shape: NULL, or not one that a dem_make function made");
    if (dem__is_running(w)) return -(int)DEM_BUSY;
    dem__convex_state *convex = &w->engine->convex;
    const dem_allocator *a = &w->def.allocator;
    const size_t size = sizeof *convex->shape, old = (size_t)convex->shapes * size;
    dem_convex own = *shape; /* `shape` may lie in the array that grows */
    dem__turn_to_axes(&own);
    if (convex->shapes == 0 && !dem__make_touch_memory(w)) return -(int)DEM_OUT_OF_MEMORY;
    dem_convex *fresh = (dem_convex *)a->fn(a->user, convex->shape, old, old + size);
    if (!fresh) return -(int)DEM_OUT_OF_MEMORY;
    convex->shape = fresh, convex->calls = dem__polyhedra();
    convex->shape[convex->shapes++] = own;
    if (convex->shapes > 1) return convex->shapes - 1;
    if (dem__take_feature(w, dem__feature_polyhedra()) == DEM_OK) return 0;
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
    if (dem__lacks_material(w, material)) return DEM_BAD_ARGUMENT;
    if (shape < 0 || shape >= w->engine->convex.shapes)
        return dem__refuse(w, "shape: the world has no shape of this index");
    if (n < 0) return dem__refuse(w, "n: below 0");
    if (n > 0 && !centres) return dem__refuse(w, "centres: NULL");
    if (n > INT32_MAX / 4 - w->count) return DEM_TOO_MANY;
    const dem_convex *s = &w->engine->convex.shape[shape];
    const double density = w->def.material[material].density;
    const dem_vec none = dem_vec3(0.0, 0.0, 0.0);
    for (ptrdiff_t k = 0; k < 3 * n; k++) {
        if (!dem__finite(centres[k])) return dem__refuse(w, "centres: a coordinate is not finite");
    }
    if (!dem__are_turns(n, orientations)) return dem__refuse(w, "orientations: a quaternion is 0 or not finite");
    if (!dem__positive(density * s->moment[0] * s->moment[1]))
        return dem__refuse(w, "shape: its inertia is not a normal number");
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
/* Returns whether a wall cut the core of its particle in the last step. */
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
DEM_API int64_t dem_core_overlap_steps(const dem_world *world) {
    return world && world->engine ? world->engine->convex.overlap_steps : 0;
}
