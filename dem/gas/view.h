/* What a flow sees of a body: its surface, its area along the flow, and its mean area across it, for the
   sphericities of Hoelzer & Sommerfeld 2008. Reads shapes and bodies; writes the views of a field, one for each shape.
   Polyhedra: closed forms. Clumps: a table of directions, from closed forms of the union's outline. */
#pragma once
#include "../base/definition.h"
#include "../base/sharp.h"
#include "../bodies/union.h"
#include "../particles/exits.h"
#include "../records/groups.h"
#include "laws.h"

/* Directions of a table: a grid of squares on three sides of a cube; opposite directions look alike. */
enum {
    DEM__VIEW_CELLS = 16,
    DEM__VIEW_ROW = DEM__VIEW_CELLS + 1,
    DEM__VIEW_SIDE = DEM__VIEW_ROW * DEM__VIEW_ROW,
    DEM__VIEW_CIRCLE = 32 /* directions of a half circle, for means */
};

/* All areas are over that of the circle of the sphere of equal volume. */
typedef struct dem__facets {
    int n;
    dem_vec normal[DEM_FACES_MAX];
    double area[DEM_FACES_MAX];
} dem__facets;

typedef struct dem__view {
    uint64_t key; /* of a polyhedron: 1 + its shape; of a clump: a hash of it, with the highest bit */
    double surface;
    dem__facets facets;                 /* of a polyhedron; none: a clump */
    double seen[3 * DEM__VIEW_SIDE][2]; /* of a clump: area along, and mean area across */
} dem__view;

/* A clump over the diameter of the sphere of its volume: centres from its centre of mass along its principal axes. */
typedef struct dem__outline {
    int n;
    dem_vec centre[DEM_CLUMP_MAX];
    double radius[DEM_CLUMP_MAX];
} dem__outline;

/* ---- polyhedra ---- */

/* Finds the faces of a polyhedron. Returns its surface. */
static inline double dem__find_facets(const dem_convex *s, dem__facets *f) {
    double plane[DEM_FACES_MAX][4], volume = 0.0, surface = 0.0;
    dem__sharp_planes(s, plane);
    f->n = s->faces;
    for (int k = 0; k < f->n; k++) {
        f->normal[k] = dem__point(plane[k]);
        f->area[k] = dem__face_area((const double(*)[4])plane, f->n, k, s->reach);
        volume += plane[k][3] * f->area[k] / 3.0;
    }
    const double x = riddle_cbrt(6.0 / RIDDLE_PI * volume), circle = 0.25 * RIDDLE_PI * x * x;
    for (int k = 0; k < f->n; k++) f->area[k] /= circle, surface += f->area[k];
    return surface;
}

/* ---- clumps ---- */

/* Returns twice the area that an uncovered arc of a circle about (x, y) encloses with the origin. */
static inline double dem__arc_area(double x, double y, double r, double from, double to) {
    return r * (r * (to - from) + x * (riddle_sin(to) - riddle_sin(from)) - y * (riddle_cos(to) - riddle_cos(from)));
}

/* Adds an arc to a list in the order of beginnings. Returns its length. */
static inline int dem__insert_arc(double (*arc)[2], int n, double from, double to) {
    int k = n;
    for (; k > 0 && arc[k - 1][0] > from; k--) arc[k][0] = arc[k - 1][0], arc[k][1] = arc[k - 1][1];
    arc[k][0] = from, arc[k][1] = to;
    return n + 1;
}

/* Lists the arcs of circle i that others cover. Returns how many; -1: all is covered. x, y: centres. */
static inline int dem__covered_arcs(const dem__outline *c, const double *x, const double *y, int i, double (*arc)[2]) {
    int n = 0;
    for (int j = 0; j < c->n; j++) {
        const double dx = x[j] - x[i], dy = y[j] - y[i], d = sqrt(dx * dx + dy * dy), r = c->radius[i],
                     other = c->radius[j];
        if (j == i || d >= r + other) continue;
        if (d + r <= other && (d + other > r || j < i)) return -1; /* of two equal circles the first counts */
        if (d + other <= r) continue;
        const double half = riddle_acos(dem__clamp((d * d + (r - other) * (r + other)) / (2.0 * d * r), -1.0, 1.0)),
                     angle = riddle_atan2(dy, dx);
        double a = angle - half, b = angle + half;
        if (a < -RIDDLE_PI) n = dem__insert_arc(arc, n, a + 2.0 * RIDDLE_PI, RIDDLE_PI), a = -RIDDLE_PI;
        if (b > RIDDLE_PI) n = dem__insert_arc(arc, n, -RIDDLE_PI, b - 2.0 * RIDDLE_PI), b = RIDDLE_PI;
        n = dem__insert_arc(arc, n, a, b);
    }
    return n;
}

/* Returns the area of a clump seen along the unit vector u. */
static inline double dem__seen_along(const dem__outline *c, dem_vec u) {
    double x[DEM_CLUMP_MAX], y[DEM_CLUMP_MAX], arc[2 * DEM_CLUMP_MAX][2], twice = 0.0;
    const dem_vec a = dem__one_across(u), b = dem__cross(u, a);
    for (int k = 0; k < c->n; k++) x[k] = dem__dot(a, c->centre[k]), y[k] = dem__dot(b, c->centre[k]);
    for (int i = 0; i < c->n; i++) {
        const int n = dem__covered_arcs(c, x, y, i, arc);
        double from = -RIDDLE_PI;
        for (int k = 0; k <= n; k++) {
            const double to = k < n ? arc[k][0] : RIDDLE_PI;
            if (to > from) twice += dem__arc_area(x[i], y[i], c->radius[i], from, to);
            if (k < n && arc[k][1] > from) from = arc[k][1];
        }
    }
    return 0.5 * twice / (0.25 * RIDDLE_PI);
}

/* Returns direction k of those of a half circle across u. */
static inline dem_vec dem__across(dem_vec u, int k) {
    const dem_vec a = dem__one_across(u);
    const double angle = RIDDLE_PI * (double)k / (double)DEM__VIEW_CIRCLE;
    return dem__plus(dem__scale(riddle_cos(angle), a), riddle_sin(angle), dem__cross(u, a));
}

/* Finds the outline of a body of spheres, over the diameter of the sphere of its own volume, and its surface. Lengths
   are rounded, so that bodies of one shape and several sizes have the same bits. */
static inline void dem__find_outline(const dem_world *w, ptrdiff_t i, dem__outline *c, double *surface) {
    const dem__pieces own = dem__pieces_of(w, i);
    const double grain = 1073741824.0, x = dem__diameter_of(w, i);
    dem__cover cap[DEM__CAPS];
    dem__exposed e;
    dem__content content;
    memset(&content, 0, sizeof content);
    c->n = (int)(own.end - own.first);
    for (int k = 0; k < c->n; k++) {
        const dem_vec o = w->engine->bodies.offset[own.first + k];
        c->centre[k] = dem_vec3(floor(o.x / x * grain + 0.5) / grain, floor(o.y / x * grain + 0.5) / grain,
                                floor(o.z / x * grain + 0.5) / grain);
        c->radius[k] = floor(w->particle[own.first + k].radius / x * grain + 0.5) / grain;
    }
    *surface = 0.0;
    for (int k = 0; k < c->n; k++) {
        dem__expose(dem__find_caps(c->n, c->centre, c->radius, k, cap), cap, &e);
        dem__add_enclosed(&content, &e, c->centre[k], c->radius[k]);
        *surface += c->radius[k] * c->radius[k] * e.zero;
    }
    const double d = riddle_cbrt(6.0 / RIDDLE_PI * content.volume);
    for (int k = 0; k < c->n; k++) c->centre[k] = dem__scale(1.0 / d, c->centre[k]), c->radius[k] /= d;
    *surface /= 0.25 * RIDDLE_PI * d * d;
}

/* Finds areas in a table, by interpolation in a square. seen: area along u, mean area across it. */
static inline void dem__read_view(const dem__view *view, dem_vec u, double *seen) {
    const double v[3] = {u.x, u.y, u.z};
    const int side = fabs(v[0]) >= fabs(v[1]) && fabs(v[0]) >= fabs(v[2]) ? 0 : fabs(v[1]) >= fabs(v[2]) ? 1 : 2;
    const double a = (0.5 + 0.5 * v[(side + 1) % 3] / v[side]) * (double)DEM__VIEW_CELLS,
                 b = (0.5 + 0.5 * v[(side + 2) % 3] / v[side]) * (double)DEM__VIEW_CELLS;
    const int i = a < DEM__VIEW_CELLS - 1 ? (int)a : DEM__VIEW_CELLS - 1,
              j = b < DEM__VIEW_CELLS - 1 ? (int)b : DEM__VIEW_CELLS - 1;
    const double p = a - i, q = b - j;
    const double(*low)[2] = &view->seen[side * DEM__VIEW_SIDE + i * DEM__VIEW_ROW + j],
          (*high)[2] = low + DEM__VIEW_ROW;
    for (int k = 0; k < 2; k++)
        seen[k] = (1.0 - p) * ((1.0 - q) * low[0][k] + q * low[1][k]) + p * ((1.0 - q) * high[0][k] + q * high[1][k]);
}

/* Returns direction k of the table. */
static inline dem_vec dem__view_direction(int k) {
    const int side = k / DEM__VIEW_SIDE, place = k % DEM__VIEW_SIDE;
    double v[3];
    v[side] = 1.0;
    v[(side + 1) % 3] = 2.0 * (place / DEM__VIEW_ROW) / (double)DEM__VIEW_CELLS - 1.0;
    v[(side + 2) % 3] = 2.0 * (place % DEM__VIEW_ROW) / (double)DEM__VIEW_CELLS - 1.0;
    return dem__scale(1.0 / dem__length(dem__point(v)), dem__point(v));
}

static inline void dem__view_clump(dem__view *view, const dem__outline *c) {
    for (int k = 0; k < 3 * DEM__VIEW_SIDE; k++)
        view->seen[k][0] = dem__seen_along(c, dem__view_direction(k)), view->seen[k][1] = 0.0;
    for (int k = 0; k < 3 * DEM__VIEW_SIDE; k++) {
        double sum = 0.0;
        for (int q = 0; q < DEM__VIEW_CIRCLE; q++) {
            double seen[2];
            dem__read_view(view, dem__across(dem__view_direction(k), q), seen);
            sum += seen[0];
        }
        view->seen[k][1] = sum / (double)DEM__VIEW_CIRCLE;
    }
    view->facets.n = 0;
}

/* ---- sphericities ---- */

/* Finds the sphericities from areas over that of the sphere's circle. */
static inline void dem__sphericities_of(double surface, double along, double across, double *psi) {
    psi[0] = surface > 4.0 ? 4.0 / surface : 1.0;
    psi[1] = 1.0 / along, psi[2] = 1.0 / (0.5 * surface - across);
}

/* Finds those of a polyhedron in a flow along the unit vector u, in its frame: a face with normal n and area a shows
   a |n u| along u, and a 2/pi |n x u| on average across it; every ray meets two faces. */
static inline void dem__see_facets(const dem__facets *f, double surface, dem_vec u, double *psi) {
    double along = 0.0, across = 0.0;
    for (int k = 0; k < f->n; k++) {
        along += 0.5 * f->area[k] * fabs(dem__dot(f->normal[k], u));
        across += f->area[k] / RIDDLE_PI * dem__length(dem__cross(f->normal[k], u));
    }
    dem__sphericities_of(surface, along, across, psi);
}

/* Returns a flow of any length as a unit vector. */
static inline dem_vec dem__flow_direction(dem_vec flow) {
    const double x = fabs(flow.x), y = fabs(flow.y), z = fabs(flow.z), size = x > y ? (x > z ? x : z) : y > z ? y : z;
    const dem_vec u = dem__scale(1.0 / size, flow);
    return size > 0.0 ? dem__scale(1.0 / dem__length(u), u) : dem_vec3(0.0, 0.0, 1.0); /* at rest drag is 0 */
}

/* Finds the sphericities of a body for a law. */
static DEM__NOINLINE void dem__find_seen_body(const dem__seen *s, dem_vec flow, double psi[3]) {
    const dem_world *w = s->world;
    const dem__field *field = &w->engine->field;
    const dem__view *view = &field->view[field->view_of[s->first] - 1];
    const dem_vec v = dem__flow_direction(flow);
    const dem_quaternion turn = dem__body_turn_at(w, s->first, s->tau);
    double seen[2];
    if (view->facets.n > 0) {
        dem__see_facets(&view->facets, view->surface, dem__to_body(dem__turn_of_polyhedron(w, s->first, turn), v), psi);
        return;
    }
    dem__read_view(view, dem__to_body(turn, v), seen);
    dem__sphericities_of(view->surface, seen[0], seen[1], psi);
}

/* Returns what a law is told about the body of particle i, tau after its origin step; NULL for a sphere. */
DEM_INLINE const dem__seen *dem__look_at(const dem_world *w, ptrdiff_t i, double tau, dem__seen *seen) {
    if (w->engine->field.view_of[i] <= 0) return NULL;
    seen->find = dem__find_seen_body, seen->world = w, seen->first = i, seen->tau = tau;
    return seen;
}

/* ---- views of a world ---- */

static inline void dem__release_views(dem_world *w) {
    dem__field *field = &w->engine->field;
    dem__release(&w->def.allocator, field->view, (size_t)field->view_capacity * sizeof *field->view);
    field->view = NULL, field->views = field->view_capacity = 0;
}

/* Returns the number of a view with this key, or a new one; -1 when out of memory. */
static inline ptrdiff_t dem__view_with(dem_world *w, uint64_t key, int *is_new) {
    dem__field *field = &w->engine->field;
    const dem_allocator *a = &w->def.allocator;
    const ptrdiff_t old = field->view_capacity, larger = old + old / 2 + 4;
    *is_new = 0;
    for (ptrdiff_t k = 0; k < field->views; k++)
        if (field->view[k].key == key) return k;
    if (field->views == old) {
        dem__view *fresh =
            (dem__view *)a->fn(a->user, field->view, (size_t)old * sizeof *fresh, (size_t)larger * sizeof *fresh);
        if (!fresh) return -1;
        field->view = fresh, field->view_capacity = larger;
    }
    *is_new = 1;
    field->view[field->views].key = key;
    return field->views++;
}

/* Returns whether a flow sees particle i as one sphere: it is one, alone or as a clump, or part of a compound. */
static inline int dem__is_seen_as_sphere(const dem_world *w, ptrdiff_t i) {
    const dem__pieces own = dem__pieces_of(w, i);
    return dem__is_part(w, i) || (!dem__shape_of(w, i) && own.end - own.first == 1);
}

/* Makes the views that bodies of a world lack. Returns 0 when out of memory. */
static inline int dem__find_views(dem_world *w) {
    dem__field *field = &w->engine->field;
    dem__outline outline;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_convex *s = dem__shape_of(w, i);
        uint64_t key = s ? (uint64_t)(s - w->engine->convex.shape) + 1 : 0xcbf29ce484222325u;
        double surface = 0.0;
        int is_new;
        if (!dem__leads(w, i) || field->view_of[i] != 0) continue;
        if (dem__is_seen_as_sphere(w, i)) {
            field->view_of[i] = -1;
            continue;
        }
        if (!s) {
            dem__find_outline(w, i, &outline, &surface);
            for (int k = 0; k < outline.n; k++)
                dem__hash_vec(&key, outline.centre[k]), dem__hash_f64(&key, &outline.radius[k], 1);
            key |= (uint64_t)1 << 63;
        }
        const ptrdiff_t k = dem__view_with(w, key, &is_new);
        if (k < 0) return 0;
        field->view_of[i] = (int32_t)k + 1;
        if (is_new && s) field->view[k].surface = dem__find_facets(s, &field->view[k].facets);
        else if (is_new) field->view[k].surface = surface, dem__view_clump(&field->view[k], &outline);
    }
    return 1;
}

DEM_API dem_status dem_body_sphericities(const dem_world *world, ptrdiff_t i, dem_vec flow, double psi[3]) {
    const dem_world *w = world;
    if (!w || !w->engine || i < 0 || i >= w->count || !psi || !dem__finite_vec(flow) || dem__length(flow) == 0.0)
        return DEM_BAD_ARGUMENT;
    const dem_convex *s = dem__shape_of(w, i);
    dem__facets facets;
    dem__outline outline;
    double surface, across = 0.0;
    psi[0] = psi[1] = psi[2] = 1.0;
    if (dem__is_seen_as_sphere(w, i)) return DEM_OK;
    const dem_vec v = dem__flow_direction(flow);
    const dem_quaternion turn = dem__body_turn_at(w, i, dem__now(w, i));
    if (s) {
        surface = dem__find_facets(s, &facets);
        dem__see_facets(&facets, surface, dem__to_body(dem__turn_of_polyhedron(w, i, turn), v), psi);
        return DEM_OK;
    }
    const dem_vec u = dem__to_body(turn, v);
    dem__find_outline(w, i, &outline, &surface);
    for (int k = 0; k < DEM__VIEW_CIRCLE; k++)
        across += dem__seen_along(&outline, dem__across(u, k)) / (double)DEM__VIEW_CIRCLE;
    dem__sphericities_of(surface, dem__seen_along(&outline, u), across, psi);
    return DEM_OK;
}
