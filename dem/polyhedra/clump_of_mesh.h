/* Clumps from closed surfaces: spheres are fitted inside, and mass properties are those of the surface. Reads a mesh;
   makes a clump; owns scratch memory while it works. Promises: no sphere reaches out of the surface, but for rounding;
   mass, centre and moments are exact. */
#pragma once
#include "../bodies/clump_shape.h"
#include "../walls/solid.h"
#include "shape.h"

#define DEM__FILL_POINTS 8000.0     /* grid points in a body: their pairs are compared */
#define DEM__FILL_NODES_MAX 2000000 /* grid points in its bounding box */

/* A point of the grid that lies in the body. */
typedef struct dem__fill_point {
    dem_vec x;
    double clear;    /* distance from the surface: radius of the greatest sphere about x [m] */
    int32_t gain;    /* points in that sphere that no chosen sphere covers */
    int32_t covered; /* by a chosen sphere */
} dem__fill_point;

/* A body to be filled, with lengths over its greatest extent and measured from the middle of its box. */
typedef struct dem__fill {
    dem__tree *tree;
    dem_vec half, centre; /* half lengths of the box; centre of mass */
    double volume, tensor[6];
    int32_t nodes[3];
    ptrdiff_t n;
    dem__fill_point *point;
} dem__fill;

/* Returns the distance of a point from a surface. */
static inline double dem__from_surface(const dem__tree *t, dem_vec p) {
    double least = HUGE_VAL, distance;
    int inside;
    for (int32_t b = 0; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, p, least)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) {
            dem__from_triangle(t, k, p, &distance, &inside);
            least = distance < least ? distance : least;
        }
    }
    return least;
}

/* Finds volume, centre of mass and tensor of inertia of a closed surface whose triangles face outwards or inwards.
   Returns 0 if it encloses no volume. */
static inline int dem__weigh_surface(dem__fill *f) {
    dem__moments bulk;
    memset(&bulk, 0, sizeof bulk);
    for (int32_t k = 0; k < 3 * f->tree->triangles; k += 3) {
        double x[3][3];
        for (int c = 0; c < 9; c++) x[c / 3][c % 3] = dem_axis(f->tree->vertex[f->tree->corner[k + c / 3]], c % 3);
        dem__add_triangle(&bulk, x[0], x[1], x[2]);
    }
    const double sign = bulk.volume < 0.0 ? -1.0 : 1.0, v = f->volume = sign * bulk.volume;
    if (!(v > 1e-9)) return 0;
    const dem_vec m = f->centre = dem__scale(sign / v, bulk.first);
    double s[3][3];
    for (int k = 0; k < 9; k++)
        s[k / 3][k % 3] = sign * bulk.second[k / 3][k % 3] - v * dem_axis(m, k / 3) * dem_axis(m, k % 3);
    for (int a = 0; a < 3; a++) {
        f->tensor[a] = s[(a + 1) % 3][(a + 1) % 3] + s[(a + 2) % 3][(a + 2) % 3];
        f->tensor[3 + a] = -s[a][(a + 1) % 3];
    }
    return f->tensor[0] > 0.0 && f->tensor[1] > 0.0 && f->tensor[2] > 0.0;
}

/* Chooses a grid with a point in the middle of the box. */
static inline void dem__choose_grid(dem__fill *f) {
    double width = riddle_cbrt(f->volume / DEM__FILL_POINTS), nodes;
    do {
        nodes = 1.0;
        for (int a = 0; a < 3; a++) {
            f->nodes[a] = 1 + 2 * (int32_t)(dem_axis(f->half, a) / width);
            nodes *= (double)f->nodes[a];
        }
        width *= 1.25;
    } while (nodes > (double)DEM__FILL_NODES_MAX);
}

/* Lists the points of the grid that lie in the body, or with point == NULL counts them. */
static inline void dem__list_fill_points(dem__fill *f) {
    f->n = 0;
    for (int32_t k = 0; k < f->nodes[0] * f->nodes[1] * f->nodes[2]; k++) {
        const int32_t at[3] = {k % f->nodes[0], k / f->nodes[0] % f->nodes[1], k / f->nodes[0] / f->nodes[1]};
        dem_vec x;
        for (int a = 0; a < 3; a++)
            *dem_axis_of(&x, a) = dem_axis(f->half, a) * ((double)(2 * at[a] + 1) / (double)f->nodes[a] - 1.0);
        if (!dem__is_inside_tree(f->tree, x)) continue;
        if (f->point) {
            dem__fill_point *p = &f->point[f->n];
            p->x = x, p->clear = dem__from_surface(f->tree, x), p->gain = p->covered = 0;
        }
        f->n++;
    }
}

/* Adds `gain` to each point whose sphere holds x. */
static inline void dem__change_gains(dem__fill *f, dem_vec x, int32_t gain) {
    for (dem__fill_point *p = f->point; p < f->point + f->n; p++) {
        const dem_vec d = dem__sub(p->x, x);
        p->gain += dem__dot(d, d) < p->clear * p->clear ? gain : 0;
    }
}

/* Chooses at most n spheres, each of which fills most of what those before it leave. Returns how many. */
static inline int dem__choose_spheres(dem__fill *f, int n, dem_vec *centre, double *diameter) {
    for (ptrdiff_t k = 0; k < f->n; k++) dem__change_gains(f, f->point[k].x, 1);
    for (int s = 0; s < n; s++) {
        const dem__fill_point *best = f->point;
        for (const dem__fill_point *p = f->point; p < f->point + f->n; p++) {
            if (p->gain > best->gain || (p->gain == best->gain && p->clear > best->clear)) best = p;
        }
        if (!(best->gain > 0 && best->clear > 0.0)) return s;
        const dem_vec x = best->x;
        const double r = best->clear;
        centre[s] = x, diameter[s] = 2.0 * r;
        for (ptrdiff_t k = 0; k < f->n; k++) {
            const dem_vec at = f->point[k].x, d = dem__sub(at, x);
            if (f->point[k].covered || !(dem__dot(d, d) < r * r)) continue;
            f->point[k].covered = 1;
            dem__change_gains(f, at, -1);
        }
    }
    return n;
}

/* Returns an element of the tensor of inertia of a clump: 0 .. 2: xx, yy, zz; 3 .. 5: xy, yz, zx. */
static inline double dem__tensor_of(const dem_clump *c, int k) {
    const dem_vec e[3] = {dem__first_axis(c->axes), dem__second_axis(c->axes), dem__third_axis(c->axes)};
    const int p = k % 3, q = k < 3 ? p : (p + 1) % 3;
    double sum = 0.0;
    for (int a = 0; a < 3; a++) sum += dem_axis(c->moments, a) * dem_axis(e[a], p) * dem_axis(e[a], q);
    return sum;
}

/* Gives a union of spheres the mass properties of the body. size, middle: of the body's box, in the frame of the mesh.
 */
static inline void dem__take_body(const dem__fill *f, double size, dem_vec middle, dem_clump *c, dem_clump_fit *fit) {
    int order[3];
    double largest = 0.0, differs = 0.0;
    for (int k = 0; k < 6; k++) {
        const double off = fabs(dem__tensor_of(c, k) - f->tensor[k]);
        differs = off > differs ? off : differs;
    }
    fit->volume = c->volume / f->volume - 1.0;
    fit->centre = dem__length(dem__sub(c->origin, f->centre)) / riddle_cbrt(6.0 / RIDDLE_PI * f->volume);
    c->moments = dem__clump_axes(f->tensor, &c->axes);
    for (int a = 0; a < 3; a++) largest = dem_axis(c->moments, a) > largest ? dem_axis(c->moments, a) : largest;
    fit->moments = differs / largest;
    dem__merge_moments(&c->moments, 1e-12);
    dem__order_moments(&c->moments, &c->axes, order);
    for (int k = 0; k < c->spheres; k++) {
        c->centre[k] = dem__scale(size, dem__add(c->centre[k], dem__sub(c->origin, f->centre)));
        c->radius[k] *= size;
    }
    c->origin = dem__plus(middle, size, f->centre);
    c->volume = f->volume * size * size * size;
    c->moments = dem__scale(size * size * size * size * size, c->moments);
}

/* Fills a body whose tree has been made. Returns a status. */
static inline dem_status dem__fill_body(const dem_allocator *a, dem__fill *f, int n, dem_clump *clump) {
    double centre[DEM_CLUMP_MAX][3], diameter[DEM_CLUMP_MAX];
    dem_vec at[DEM_CLUMP_MAX];
    if (!dem__weigh_surface(f)) return DEM_BAD_ARGUMENT;
    dem__choose_grid(f);
    dem__list_fill_points(f);
    const size_t bytes = (size_t)f->n * sizeof *f->point;
    if (f->n == 0) return DEM_BAD_ARGUMENT;
    f->point = (dem__fill_point *)a->fn(a->user, NULL, 0, bytes);
    if (!f->point) return DEM_OUT_OF_MEMORY;
    dem__list_fill_points(f);
    const int chosen = dem__choose_spheres(f, n, at, diameter);
    a->fn(a->user, f->point, bytes, 0);
    for (int k = 0; k < 3 * chosen; k++) centre[k / 3][k % 3] = dem_axis(at[k / 3], k % 3);
    return dem_make_clump(chosen, centre[0], diameter, clump);
}

DEM_API dem_status dem_make_clump_from_mesh(const dem_mesh *mesh, int n, const dem_allocator *allocator,
                                            dem_clump *clump, dem_clump_fit *fit) {
    dem_allocator a;
    dem_clump_fit own;
    dem__fill f;
    dem_vec low, high;
    dem_status status = DEM_OUT_OF_MEMORY;
    memset(&a, 0, sizeof a), memset(&f, 0, sizeof f);
    a.fn = dem__default_allocator;
    if (allocator) a = *allocator;
    if (!clump || n < 1 || !dem__is_mesh(mesh, &low, &high)) return DEM_BAD_ARGUMENT;
    if (n > DEM_CLUMP_MAX) return DEM_TOO_MANY;
    const dem_vec d = dem__sub(high, low), middle = dem__plus(low, 0.5, d);
    const double size = d.x > d.y ? (d.x > d.z ? d.x : d.z) : d.y > d.z ? d.y : d.z;
    const size_t bytes = (size_t)mesh->vertices * sizeof(dem_vec);
    if (!(size >= 1e-30 && size <= 1e30)) return DEM_BAD_ARGUMENT;
    dem_vec *vertex = (dem_vec *)a.fn(a.user, NULL, 0, bytes);
    if (!vertex) return DEM_OUT_OF_MEMORY;
    for (ptrdiff_t k = 0; k < mesh->vertices; k++)
        vertex[k] = dem__scale(1.0 / size, dem__sub(dem__point(mesh->vertex + 3 * k), middle));
    f.half = dem__scale(0.5 / size, d);
    status = dem__check_closed(&a, mesh->triangles, vertex, mesh->triangle);
    if (status == DEM_OK) f.tree = dem__make_tree(&a, mesh->vertices, vertex, mesh->triangles, mesh->triangle, &status);
    a.fn(a.user, vertex, bytes, 0);
    if (!f.tree) return status;
    dem_clump made;
    status = dem__fill_body(&a, &f, n, &made);
    a.fn(a.user, f.tree, f.tree->bytes, 0);
    if (status != DEM_OK) return status;
    dem__take_body(&f, size, middle, &made, fit ? fit : &own);
    *clump = made;
    return DEM_OK;
}
