/* The spheres in and near a region that is being filled, which tell whether a place is free. */
#pragma once
#include "../bodies/clumps.h"
#include "sizes.h"

/* Spheres in and near a region, present and new, in linked lists by level and cell. */
typedef struct dem__room {
    dem__grid grid[DEM__LEVELS_MAX];
    double smallest;
    double *centre, *radius; /* [count][3], [count] */
    int32_t *head, *next;
    ptrdiff_t count, capacity, cells;
    size_t bytes;
    dem_wall inside;  /* the triangles of a mesh region; for other regions there is no tree */
    ptrdiff_t looked; /* places tried */
    int stopped;      /* by def.stop */
} dem__room;

/* Returns whether the host wants the call to end. Asks in every 1024th step of the work. */
static inline int dem__is_stopped(const dem_world *w, ptrdiff_t step) {
    return (step & 1023) == 1023 && w->def.stop && w->def.stop(w->def.stop_user) != 0;
}

/* Adds a sphere to the lists. */
static inline void dem__occupy(dem__room *room, dem_vec x, double radius) {
    const ptrdiff_t k = room->count++, c = dem__cell(&room->grid[dem__level(radius, room->smallest)], x);
    room->centre[3 * k] = x.x, room->centre[3 * k + 1] = x.y, room->centre[3 * k + 2] = x.z;
    room->radius[k] = radius;
    room->next[k] = room->head[c];
    room->head[c] = (int32_t)k;
}

/* Counts a sphere that will be added, for the sizes of cells and arrays. */
static inline void dem__count_in(dem__room *room, double radius) {
    dem__grid *g = &room->grid[dem__level(radius, room->smallest)];
    g->count++;
    g->widest = radius > g->widest ? radius : g->widest;
    room->capacity++;
}

/* Returns whether sphere i reaches into a box. x: its position. Periodic axes are not compared. */
static inline int dem__reaches_box(const dem_world *w, ptrdiff_t i, dem_vec low, dem_vec high, dem_vec *x) {
    *x = dem_position(w, i);
    for (int a = 0; a < 3 && w->alive[i]; a++) {
        const double v = dem_axis(*x, a);
        if (!w->def.periodic[a] &&
            !(v + w->particle[i].radius >= dem_axis(low, a) && v - w->particle[i].radius <= dem_axis(high, a)))
            return 0;
    }
    return w->alive[i];
}

/* Builds the tree of a mesh region. */
static inline dem_status dem__make_inside(dem_wall *inside, const dem_world *w, const dem_region *region) {
    const dem_mesh *m = region->mesh;
    dem_status status = DEM_OK;
    if (region->kind != DEM_REGION_MESH) return DEM_OK;
    inside->kind__ = dem__triangles(), inside->solid = 1;
    dem__frame(inside, dem_vec3(0.0, 0.0, 1.0), dem_vec3(1.0, 0.0, 0.0));
    inside->tree = dem__make_tree(&w->def.allocator, m->vertices, (const dem_vec *)(const void *)m->vertex,
                                  m->triangles, m->triangle, &status);
    return status;
}

/* Frees the memory of a room. */
static inline void dem__clear_room(dem__room *room, const dem_world *w) {
    const dem_allocator *a = &w->def.allocator;
    if (room->centre) a->fn(a->user, room->centre, room->bytes, 0);
    if (room->inside.tree) a->fn(a->user, room->inside.tree, room->inside.tree->bytes, 0);
    room->centre = NULL, room->inside.tree = NULL;
}

/* Makes a room for the present spheres around a region and n new ones with given radii. reach: of the largest new body
   [m]. */
static inline dem_status dem__make_room(dem__room *room, const dem_world *w, const dem_region *region,
                                        const double *radius, ptrdiff_t n, double reach) {
    dem_vec low, high, x;
    memset(room, 0, sizeof *room);
    const dem_status status = dem__make_inside(&room->inside, w, region);
    if (status != DEM_OK) return status;
    dem__tree_bounds(region, &low, &high);
    room->smallest = HUGE_VAL;
    for (ptrdiff_t k = 0; k < n; k++) {
        room->smallest = radius[k] < room->smallest ? radius[k] : room->smallest;
    }
    const dem_vec out = dem_vec3(reach, reach, reach); /* spheres protrude from a flat region */
    low = dem__sub(low, out), high = dem__add(high, out);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (dem__reaches_box(w, i, low, high, &x) && w->particle[i].radius < room->smallest)
            room->smallest = w->particle[i].radius;
    }
    for (ptrdiff_t k = 0; k < n; k++) dem__count_in(room, radius[k]);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (dem__reaches_box(w, i, low, high, &x)) dem__count_in(room, w->particle[i].radius);
    }
    for (int level = 0; level < DEM__LEVELS_MAX; level++) {
        dem__grid *g = &room->grid[level];
        if (g->count == 0) continue;
        dem__make_grid(w, g, 2.0 * g->widest, low, high);
        g->first = room->cells;
        room->cells += (ptrdiff_t)g->n[0] * g->n[1] * g->n[2];
    }
    if (room->capacity > INT32_MAX / 8) return DEM_TOO_MANY;
    room->bytes =
        (size_t)room->capacity * (4 * sizeof(double) + sizeof(int32_t)) + (size_t)room->cells * sizeof(int32_t);
    room->centre = (double *)w->def.allocator.fn(w->def.allocator.user, NULL, 0, room->bytes);
    if (!room->centre) return DEM_OUT_OF_MEMORY;
    room->radius = room->centre + 3 * room->capacity;
    room->next = (int32_t *)(void *)(room->radius + room->capacity);
    room->head = room->next + room->capacity;
    for (ptrdiff_t c = 0; c < room->cells; c++) room->head[c] = -1;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (dem__reaches_box(w, i, low, high, &x)) dem__occupy(room, x, w->particle[i].radius);
    }
    return DEM_OK;
}

/* Returns whether a sphere of a group is free at x: it overlaps no sphere and no wall, and is not inside a solid wall,
   beyond an exit or outside a mesh region. */
static inline int dem__is_free(const dem_world *w, const dem__room *room, dem_vec x, double radius, int group) {
    dem__touch touch[DEM__TOUCHES];
    double least;
    if (room->inside.tree &&
        (!dem__is_inside_wall(&room->inside, x) || dem__touch_wall(&room->inside, x, radius, 0.0, touch, &least) > 0))
        return 0;
    for (int k = 0; k < w->walls; k++) {
        const dem_wall *wall = &w->wall[k];
        if (!wall->enabled || !dem__acts_on(wall, group)) continue;
        if (dem__touch_wall(wall, x, radius, 0.0, touch, &least) > 0 || dem__is_inside_wall(wall, x)) return 0;
    }
    for (int level = 0; level < DEM__LEVELS_MAX; level++) {
        const dem__grid *g = &room->grid[level];
        if (g->count == 0) continue;
        int32_t first[3], cells[3];
        for (int a = 0; a < 3; a++) cells[a] = dem__cells(g, a, dem_axis(x, a), radius + g->widest, &first[a]);
        for (int32_t c = 0; c < cells[0] * cells[1] * cells[2]; c++) {
            const int32_t step[3] = {c % cells[0], c / cells[0] % cells[1], c / cells[0] / cells[1]};
            ptrdiff_t at[3];
            for (int a = 0; a < 3; a++)
                at[a] = first[a] + step[a] < g->n[a] ? first[a] + step[a] : first[a] + step[a] - g->n[a];
            for (int32_t q = room->head[g->first + (at[2] * g->n[1] + at[1]) * g->n[0] + at[0]]; q >= 0;
                 q = room->next[q]) {
                const double *p = room->centre + 3 * (ptrdiff_t)q, sum = radius + room->radius[q];
                const dem_vec d = dem__nearest_image(w, dem_vec3(x.x - p[0], x.y - p[1], x.z - p[2]));
                if (dem__dot(d, d) < sum * sum) return 0;
            }
        }
    }
    return 1;
}
