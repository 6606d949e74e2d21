/* dem_io.h: a dem_world in files and pictures: ParaView series of particles and moving walls, sections to scale,
   surfaces as triangles.

   #include "dem_io.h"

   int main(void) {
       dem_def def = dem_default_def();
       int glass = dem_add_material(&def, 2500.0, 5e9, 0.2);
       double centre[] = {0.0, 0.0, 0.02}, diameter[] = {0.01};
       dem_world world;
       if (dem_init(&world, &def, NULL) != DEM_OK) return 1;
       dem_add_plane(&world, glass, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
       dem_add_spheres(&world, 1, centre, diameter, glass, 0);
       riddle_plot *figure = riddle_plot_new("A ball above a floor", 1, 1);
       dem_io_section(&world, figure, dem_vec3(0, 0, 0), dem_vec3(0, -1, 0), dem_vec3(1, 0, 0), NULL, 0);
       riddle_plot_write(figure, NULL, "/dev/null");                        // folder and file: "out", "ball.svg"
       dem_free(&world);
   }

   A series: dem_io_series s = dem_io_open("out", "drum"); then dem_io_add(&s, &world) at each frame, and
   dem_io_close(&s). It writes out/drum.pvd (particles) and out/drum_walls.pvd (walls, wires and meshes where they are
   at that time); open both in ParaView, and show the particles as spheres: filter Glyph, scale array diameter_m,
   factor 1; or Point Gaussian.

   Surfaces Walls without an end (planes, cylinders) are cut off at the box that holds particles and finite walls, and
            that is extended to planes beside it, nearer than ten of its diagonals; a plane across a cylinder is drawn
            as its end. Exits are not drawn.
   Units    SI; sections in mm.
   Memory   from the world's allocator, given back before the call returns; of a surface, by dem_io_free_surface.
   Errors   of files: riddle_io_status, with its line (riddle_io.h); else dem_status.
   Threads  a world is only read. Bits: nothing of the simulation depends on what is written.
   Linking  with dem.h, riddle_io.h and riddle_plot.h beside it. Every function is static inline; for one shared copy
            #define DEM_IO_API extern before every inclusion, and DEM_IO_IMPLEMENTATION as well in one file; those
            headers have their own switches. */
#ifndef DEM_IO_H
#define DEM_IO_H

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "dem_io.h needs NaN and infinity: compile without -ffast-math"
#endif

#include "dem.h"
#include "riddle_io.h"
#include "riddle_plot.h"

#include <math.h>
#include <stddef.h>

#ifndef DEM_IO_API
#define DEM_IO_API static inline
#define DEM_IO__BODIES
#elif defined(DEM_IO_IMPLEMENTATION)
#define DEM_IO__BODIES
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ================================================= >>declarations ================================================= */

/* Walls as triangles. The corners of a wall follow each other; round walls have 64 sides. Made by dem_io_surface_of. */
typedef struct dem_io_surface {
    int vertices, triangles;
    double *vertex;          /* shape [vertices][3] [m] */
    int *triangle;           /* shape [triangles][3]: indices of vertices; counter-clockwise around the
                                outward normal */
    int *wall;               /* [vertices]: index of the wall */
    dem_allocator allocator; /* of block */
    void *block;             /* what dem_io_free_surface frees */
    size_t bytes;
} dem_io_surface;

/* Finds the box that contains all particles and all walls of finite size now, and the cylinders around them [m]. */
DEM_IO_API void dem_io_bounds(const dem_world *world, dem_vec *low, dem_vec *high);
/* Makes the surface of the enabled walls at their present places. DEM_OUT_OF_MEMORY leaves an empty surface. */
DEM_IO_API dem_status dem_io_surface_of(const dem_world *world, dem_io_surface *surface);
/* The same for the polyhedra that are present: their faces, with flat strips and corners instead of the round ones;
   wall: the particle. */
DEM_IO_API dem_status dem_io_polyhedra_of(const dem_world *world, dem_io_surface *surface);
DEM_IO_API void dem_io_free_surface(dem_io_surface *surface); /* safe on a zeroed or freed one */

/* Write one .vtp file. dem_io_particles: the particles with diameter_m, velocity_m_s, spin_rad_s, group, material, id;
   where there are clumps or polyhedra also body, the id of its first particle, and orientation_w, orientation_xyz, the
   quaternion of dem_orientation(). dem_io_walls: the walls, with their index as array "wall". dem_io_polyhedra: the
   polyhedra's surfaces, with the particle's index as array "particle". */
DEM_IO_API riddle_io_status dem_io_particles(const dem_world *world, const char *folder, const char *name);
DEM_IO_API riddle_io_status dem_io_walls(const dem_world *world, const char *folder, const char *name);
DEM_IO_API riddle_io_status dem_io_polyhedra(const dem_world *world, const char *folder, const char *name);

/* A series of all in time: NAME.pvd, NAME_walls.pvd and, from the first frame of a world that has shapes on,
   NAME_polyhedra.pvd. The caller owns it; folder and name must live as long. A name of more than 990 bytes is refused:
   particles is then NULL. A frame of which a part could not be written is told by its status; the index leaves that
   part out, and the parts after it. */
typedef struct dem_io_series {
    const char *folder, *name;
    riddle_io_series *particles, *walls, *polyhedra;
} dem_io_series;
DEM_IO_API dem_io_series dem_io_open(const char *folder, const char *name); /* name: without an ending */
DEM_IO_API riddle_io_status dem_io_add(dem_io_series *series, const dem_world *world);
DEM_IO_API riddle_io_status dem_io_close(dem_io_series *series);

/* Draws a section into the chosen panel of a figure: the spheres cut by the plane through `point`, seen against
   `normal` with `right` to the right, as discs of the size at which they are cut, coloured by group (its last three
   bits: 8 colours), and the walls as lines, with a scale bar in mm (riddle_plot_scale_bar; with NULL after this call:
   axes). names[n_names] label the groups 0 .. n_names-1 in the legend; NULL: no legend. DEM_BAD_ARGUMENT if normal and
   right are parallel, or one of the three is not finite. */
DEM_IO_API dem_status dem_io_section(const dem_world *world, riddle_plot *figure, dem_vec point, dem_vec normal,
                                     dem_vec right, const char *const *names, int n_names);

#ifdef DEM_IO__BODIES

#include <limits.h>
#include <string.h>

/* =================================================== >>surfaces =================================================== */

static inline dem_vec dem_io__along(dem_vec from, double way, dem_vec direction) {
    return dem_vec3(from.x + way * direction.x, from.y + way * direction.y, from.z + way * direction.z);
}
static inline double dem_io__dot(dem_vec a, dem_vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline dem_vec dem_io__cross(dem_vec a, dem_vec b) {
    return dem_vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline int dem_io__is_there(const dem_world *world, ptrdiff_t i) { return world->alive[i] != 0; }

#define DEM_IO__SIDES 64     /* sides of a round surface */
#define DEM_IO__BAR_SIDES 12 /* of a wire */
#define DEM_IO__RINGS 24     /* of a sphere, from pole to pole */

static inline double dem_io__pi(void) { return 3.14159265358979323846; }

static inline int dem_io__corner(dem_io_surface *s, int wall, dem_vec at) {
    double *x = &s->vertex[3 * (size_t)s->vertices];
    x[0] = at.x, x[1] = at.y, x[2] = at.z;
    s->wall[s->vertices] = wall;
    return s->vertices++;
}

static inline void dem_io__face(dem_io_surface *s, int a, int b, int c) {
    int *t = &s->triangle[3 * (size_t)s->triangles++];
    t[0] = a, t[1] = b, t[2] = c;
}

/* Returns a point of the circle around `centre` in the plane of two unit vectors: number `side` of `sides` evenly
   spaced ones. */
static inline dem_vec dem_io__on_circle(dem_vec centre, dem_vec u, dem_vec v, double radius, int side, int sides) {
    const double angle = 2.0 * dem_io__pi() * side / sides;
    return dem_io__along(dem_io__along(centre, radius * cos(angle), u), radius * sin(angle), v);
}

/* Adds a convex polygon, whose corners are consecutive vertices, as a fan of triangles. */
static inline void dem_io__fan(dem_io_surface *s, int first, int corners) {
    for (int k = 2; k < corners; k++) dem_io__face(s, first, first + k - 1, first + k);
}

/* Adds the strip between two rings of `sides` vertices, the second of which follows the first. */
static inline void dem_io__strip(dem_io_surface *s, int first, int sides) {
    for (int k = 0; k < sides; k++) {
        const int next = (k + 1) % sides;
        dem_io__face(s, first + k, first + next, first + sides + k);
        dem_io__face(s, first + next, first + sides + next, first + sides + k);
    }
}

/* Adds the end of a cylinder around particles that a plane closes, if there is one. Returns whether it did. */
static inline int dem_io__disc(dem_io_surface *s, const dem_world *world, int index) {
    const dem_wall *plane = &world->wall[index];
    for (int k = 0; k < world->walls; k++) {
        const dem_wall *c = &world->wall[k];
        const double along = dem_io__dot(plane->axis[2], c->axis[2]);
        if (c->kind != DEM_CYLINDER || !c->enabled || !c->inside || !(fabs(along) > 0.9999)) continue;
        const double way = dem_io__dot(dem_io__along(plane->position, -1.0, c->position), plane->axis[2]) / along;
        const dem_vec centre = dem_io__along(c->position, way, c->axis[2]);
        const int first = s->vertices;
        for (int n = 0; n < DEM_IO__SIDES; n++)
            dem_io__corner(s, index,
                           dem_io__on_circle(centre, plane->axis[0], plane->axis[1], c->radius, n, DEM_IO__SIDES));
        dem_io__fan(s, first, DEM_IO__SIDES);
        return 1;
    }
    return 0;
}

/* Adds the part of a plane inside a box: a large square, cut by the six sides one after the other (Sutherland &
   Hodgman 1974). */
static inline void dem_io__plane(dem_io_surface *s, const dem_world *world, int index, dem_vec low, dem_vec high) {
    const dem_wall *w = &world->wall[index];
    dem_vec polygon[16], cut[16];
    int n = 4;
    if (dem_io__disc(s, world, index)) return;
    const dem_vec middle = dem_vec3(0.5 * (low.x + high.x), 0.5 * (low.y + high.y), 0.5 * (low.z + high.z));
    const dem_vec to = dem_io__along(middle, -1.0, w->position);
    const dem_vec centre = dem_io__along(middle, -dem_io__dot(to, w->axis[2]), w->axis[2]);
    const double reach = 2.0 * ((high.x - low.x) + (high.y - low.y) + (high.z - low.z));
    for (int k = 0; k < 4; k++) /* counter-clockwise about the normal */
        polygon[k] = dem_io__along(dem_io__along(centre, k == 0 || k == 3 ? reach : -reach, w->axis[0]),
                                   k < 2 ? reach : -reach, w->axis[1]);
    for (int side = 0; side < 6; side++) {
        const int axis = side / 2, m = n;
        const double sign = side % 2 ? -1.0 : 1.0, bound = sign * dem_axis(side % 2 ? high : low, axis);
        n = 0;
        for (int k = 0; k < m; k++) {
            const dem_vec a = polygon[k], b = polygon[(k + 1) % m];
            const double da = sign * dem_axis(a, axis) - bound, db = sign * dem_axis(b, axis) - bound;
            if (da >= 0.0) cut[n++] = a;
            if ((da >= 0.0) != (db >= 0.0)) cut[n++] = dem_io__along(a, da / (da - db), dem_io__along(b, -1.0, a));
        }
        memcpy(polygon, cut, sizeof polygon);
    }
    const int first = s->vertices;
    for (int k = 0; k < n; k++) dem_io__corner(s, index, polygon[k]);
    dem_io__fan(s, first, n);
}

static inline void dem_io__tube(dem_io_surface *s, const dem_wall *w, int index, double from, double to,
                                double from_radius, double to_radius) {
    const int first = s->vertices;
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < DEM_IO__SIDES; k++)
            dem_io__corner(s, index,
                           dem_io__on_circle(dem_io__along(w->position, end ? to : from, w->axis[2]), w->axis[0],
                                             w->axis[1], end ? to_radius : from_radius, k, DEM_IO__SIDES));
    dem_io__strip(s, first, DEM_IO__SIDES);
}

/* Adds the part of a cylinder that lies beside a box. */
static inline void dem_io__cylinder(dem_io_surface *s, const dem_wall *w, int index, dem_vec low, dem_vec high) {
    double from = HUGE_VAL, to = -HUGE_VAL;
    for (int k = 0; k < 8; k++) {
        const dem_vec corner = dem_vec3(k & 1 ? high.x : low.x, k & 2 ? high.y : low.y, k & 4 ? high.z : low.z);
        const double at = dem_io__dot(dem_io__along(corner, -1.0, w->position), w->axis[2]);
        from = at < from ? at : from;
        to = at > to ? at : to;
    }
    dem_io__tube(s, w, index, from, to, w->radius, w->radius);
}

static inline void dem_io__ball(dem_io_surface *s, const dem_wall *w, int index) {
    const int first = s->vertices;
    for (int ring = 0; ring <= DEM_IO__RINGS; ring++) {
        const double angle = dem_io__pi() * ring / DEM_IO__RINGS;
        for (int k = 0; k < DEM_IO__SIDES; k++)
            dem_io__corner(s, index,
                           dem_io__on_circle(dem_io__along(w->position, -w->radius * cos(angle), w->axis[2]),
                                             w->axis[0], w->axis[1], w->radius * sin(angle), k, DEM_IO__SIDES));
    }
    for (int ring = 0; ring < DEM_IO__RINGS; ring++) dem_io__strip(s, first + ring * DEM_IO__SIDES, DEM_IO__SIDES);
}

static inline int dem_io__bars_beside(const dem_wall *w, int family) {
    return (int)((w->circular || family == 1 ? w->half_x : w->half_y) / (w->aperture + w->wire) + 0.5);
}

/* Bars along axis[family], a pitch apart, the first half a pitch from the centre; flat below where they are
   semicircles. */
static inline void dem_io__bars(dem_io_surface *s, const dem_wall *w, int index, int family) {
    const double pitch = w->aperture + w->wire, radius = 0.5 * w->wire;
    const dem_vec along = w->axis[family], across = w->axis[1 - family];
    const int beside = dem_io__bars_beside(w, family);
    for (int bar = -beside; bar < beside; bar++) {
        const double at = (bar + 0.5) * pitch, room = w->half_x * w->half_x - at * at;
        if (w->circular && !(room > 0.0)) continue; /* a bar along the edge is none */
        const double half = w->circular ? sqrt(room) : family == 0 ? w->half_x : w->half_y;
        const int first = s->vertices, sides = DEM_IO__BAR_SIDES;
        for (int end = 0; end < 2; end++)
            for (int k = 0; k < sides; k++) {
                const dem_vec centre = dem_io__along(dem_io__along(w->position, at, across), end ? half : -half, along);
                const double angle =
                    (w->profile == DEM_ROUND ? 2.0 * k / sides : (double)k / (sides - 1)) * dem_io__pi();
                dem_io__corner(
                    s, index,
                    dem_io__along(dem_io__along(centre, radius * cos(angle), across), radius * sin(angle), w->axis[2]));
            }
        dem_io__strip(s, first, sides);
        dem_io__fan(s, first, sides);
        dem_io__fan(s, first + sides, sides);
    }
}

static inline void dem_io__mesh(dem_io_surface *s, const dem_wall *w, int index) {
    const int first = s->vertices;
    for (int k = 0; k < w->tree->vertices; k++) {
        const dem_vec v = w->tree->vertex[k];
        dem_io__corner(s, index,
                       dem_io__along(dem_io__along(dem_io__along(w->position, v.x, w->axis[0]), v.y, w->axis[1]), v.z,
                                     w->axis[2]));
    }
    for (int k = 0; k < w->tree->triangles; k++) {
        const int32_t *c = &w->tree->corner[3 * k];
        dem_io__face(s, first + c[0], first + c[1], first + c[2]);
    }
}

/* Adds an upper limit of the number of corners and faces of a wall to *vertices and *triangles. */
static inline void dem_io__size(const dem_wall *w, double *vertices, double *triangles) {
    switch (w->kind) {
    case DEM_SCREEN: {
        const double bars = 2.0 * (dem_io__bars_beside(w, 0) + (double)dem_io__bars_beside(w, 1));
        *vertices += 2.0 * DEM_IO__BAR_SIDES * bars;
        *triangles += 4.0 * DEM_IO__BAR_SIDES * bars;
        break;
    }
    case DEM_SPHERE:
        *vertices += (DEM_IO__RINGS + 1) * (double)DEM_IO__SIDES;
        *triangles += 2.0 * DEM_IO__RINGS * (double)DEM_IO__SIDES;
        break;
    case DEM_MESH:
        *vertices += w->tree->vertices;
        *triangles += w->tree->triangles;
        break;
    default: *vertices += 2.0 * DEM_IO__SIDES, *triangles += 2.0 * DEM_IO__SIDES;
    }
}

static inline void dem_io__grow(dem_vec *low, dem_vec *high, dem_vec at, double room) {
    for (int c = 0; c < 3; c++) {
        const double x = dem_axis(at, c);
        if (!(x - x == 0.0)) continue;
        if (x - room < dem_axis(*low, c)) *dem_axis_of(low, c) = x - room;
        if (x + room > dem_axis(*high, c)) *dem_axis_of(high, c) = x + room;
    }
}

static inline void dem_io__grow_by_wall(dem_vec *low, dem_vec *high, const dem_wall *w) {
    const double deck = w->circular ? w->half_x : sqrt(w->half_x * w->half_x + w->half_y * w->half_y);
    switch (w->kind) {
    case DEM_SCREEN: /* flat across its normal */
        for (int k = 0; k < 8; k++)
            dem_io__grow(low, high, dem_io__on_circle(w->position, w->axis[0], w->axis[1], deck, k, 8), 0.5 * w->wire);
        break;
    case DEM_SPHERE: dem_io__grow(low, high, w->position, w->radius); break;
    case DEM_CONE:
    case DEM_DISC:
        for (int k = 0; k < 16; k++) {
            dem_io__grow(low, high, dem_io__on_circle(w->position, w->axis[0], w->axis[1], w->radius, k, 16), 0.0);
            dem_io__grow(low, high,
                         dem_io__on_circle(dem_io__along(w->position, w->length, w->axis[2]), w->axis[0], w->axis[1],
                                           w->high_radius, k, 16),
                         0.0);
        }
        break;
    case DEM_MESH:
        for (int k = 0; k < w->tree->vertices; k++) {
            const dem_vec v = w->tree->vertex[k];
            dem_io__grow(low, high,
                         dem_io__along(dem_io__along(dem_io__along(w->position, v.x, w->axis[0]), v.y, w->axis[1]), v.z,
                                       w->axis[2]),
                         0.0);
        }
        break;
    default: break;
    }
}

DEM_IO_API void dem_io_bounds(const dem_world *world, dem_vec *low, dem_vec *high) {
    if (!low || !high) return;
    *low = dem_vec3(HUGE_VAL, HUGE_VAL, HUGE_VAL);
    *high = dem_vec3(-HUGE_VAL, -HUGE_VAL, -HUGE_VAL);
    for (ptrdiff_t i = 0; world && i < world->count; i++)
        if (dem_io__is_there(world, i)) dem_io__grow(low, high, dem_position(world, i), dem_radius(world, i));
    for (int k = 0; world && k < world->walls; k++)
        if (world->wall[k].enabled) dem_io__grow_by_wall(low, high, &world->wall[k]);
    if (!(low->x <= high->x)) *low = dem_vec3(-0.5, -0.5, -0.5), *high = dem_vec3(0.5, 0.5, 0.5);
    for (int k = 0; world && k < world->walls; k++) { /* a cylinder's width, where it stands along an axis */
        const dem_wall *w = &world->wall[k];
        if (w->kind != DEM_CYLINDER || !w->enabled) continue;
        for (int c = 0; c < 3; c++) {
            const double slope = dem_axis(w->axis[2], c),
                         reach = w->radius * sqrt(slope * slope < 1.0 ? 1.0 - slope * slope : 0.0);
            const double at = dem_axis(w->position, c);
            if (fabs(slope) > 1e-3 || !(reach > 0.0)) continue;
            if (at - reach < dem_axis(*low, c)) *dem_axis_of(low, c) = at - reach;
            if (at + reach > dem_axis(*high, c)) *dem_axis_of(high, c) = at + reach;
        }
    }
}

/* Allocates one block for so many corners and triangles. */
static inline dem_status dem_io__allot(const dem_world *world, double vertices, double triangles, dem_io_surface *s) {
    if (!(vertices < INT_MAX / 4 && triangles < INT_MAX / 4)) return DEM_TOO_MANY;
    const size_t v = (size_t)vertices, t = (size_t)triangles;
    s->allocator = world->def.allocator;
    s->bytes = v * (3 * sizeof *s->vertex + sizeof *s->wall) + 3 * t * sizeof *s->triangle;
    s->block = s->allocator.fn(s->allocator.user, NULL, 0, s->bytes);
    if (!s->block) return DEM_OUT_OF_MEMORY;
    s->vertex = (double *)s->block;
    s->wall = (int *)(void *)(s->vertex + 3 * v);
    s->triangle = s->wall + v;
    return DEM_OK;
}

/* Allocates one block that is large enough for all enabled walls. */
static inline dem_status dem_io__make_room(const dem_world *world, dem_io_surface *s) {
    double vertices = 1.0, triangles = 1.0;
    for (int k = 0; k < world->walls; k++)
        if (world->wall[k].enabled) dem_io__size(&world->wall[k], &vertices, &triangles);
    return dem_io__allot(world, vertices, triangles, s);
}

/* Extends a box by its projection on each plane beside it, unless that is far away, so that a floor shows before
   anything lies on it. */
static inline void dem_io__grow_to_planes(const dem_world *world, dem_vec *low, dem_vec *high) {
    const dem_vec from = *low, to = *high, across = dem_io__along(to, -1.0, from);
    const double limit = 10.0 * sqrt(dem_io__dot(across, across));
    for (int k = 0; k < world->walls; k++) {
        const dem_wall *w = &world->wall[k];
        if (w->kind != DEM_PLANE || !w->enabled) continue;
        const dem_vec n = w->axis[2];
        const double way = dem_io__dot(dem_io__along(dem_io__along(from, 0.5, across), -1.0, w->position), n);
        const double reach = 0.5 * (fabs(n.x) * across.x + fabs(n.y) * across.y + fabs(n.z) * across.z);
        if (!(fabs(way) > reach && fabs(way) < limit)) continue;
        for (int c = 0; c < 8; c++) {
            const dem_vec corner = dem_vec3(c & 1 ? to.x : from.x, c & 2 ? to.y : from.y, c & 4 ? to.z : from.z);
            dem_io__grow(low, high, dem_io__along(corner, -dem_io__dot(dem_io__along(corner, -1.0, w->position), n), n),
                         0.0);
        }
    }
}

DEM_IO_API dem_status dem_io_surface_of(const dem_world *world, dem_io_surface *surface) {
    dem_vec low, high;
    if (!surface) return DEM_BAD_ARGUMENT;
    memset(surface, 0, sizeof *surface);
    if (!world || !world->def.allocator.fn) return DEM_BAD_ARGUMENT;
    const dem_status status = dem_io__make_room(world, surface);
    if (status != DEM_OK) return status;
    dem_io_bounds(world, &low, &high);
    dem_io__grow_to_planes(world, &low, &high);
    const double margin = 1e-3 * ((high.x - low.x) + (high.y - low.y) + (high.z - low.z)); /* includes a floor below */
    low = dem_vec3(low.x - margin, low.y - margin, low.z - margin);
    high = dem_vec3(high.x + margin, high.y + margin, high.z + margin);
    for (int k = 0; k < world->walls; k++) {
        const dem_wall *w = &world->wall[k];
        if (!w->enabled) continue;
        switch (w->kind) {
        case DEM_PLANE: dem_io__plane(surface, world, k, low, high); break;
        case DEM_CYLINDER: dem_io__cylinder(surface, w, k, low, high); break;
        case DEM_CONE:
        case DEM_DISC: dem_io__tube(surface, w, k, 0.0, w->length, w->radius, w->high_radius); break;
        case DEM_SPHERE: dem_io__ball(surface, w, k); break;
        case DEM_SCREEN: dem_io__bars(surface, w, k, 0), dem_io__bars(surface, w, k, 1); break;
        case DEM_MESH: dem_io__mesh(surface, w, k); break;
        default: break; /* an exit is not touched */
        }
    }
    return DEM_OK;
}

/* Returns where corner k of a shape stands in the list of face f, or -1. */
static inline int dem_io__place_in_face(const dem_convex *c, int f, int k) {
    for (int q = c->face_start[f]; q < c->face_start[f + 1]; q++)
        if (c->face_corner[q] == k) return q;
    return -1;
}

/* Returns a vector of a body's frame in the world's, by the quaternion q. */
static inline dem_vec dem_io__turned(dem_quaternion q, dem_vec v) {
    const dem_vec u = dem_vec3(q.x, q.y, q.z),
                  t = dem_io__along(dem_io__along(dem_vec3(0, 0, 0), q.w, v), 1.0, dem_io__cross(u, v));
    return dem_io__along(v, 2.0, dem_io__cross(u, t));
}

/* Returns a vector along the axes of a shape's corners in the frame in which the shape was given. */
static inline dem_vec dem_io__given(const dem_convex *c, dem_vec v) {
    const dem_vec x = dem_io__along(dem_vec3(0, 0, 0), v.x, c->axis[0]);
    return dem_io__along(dem_io__along(x, v.y, c->axis[1]), v.z, c->axis[2]);
}

/* Adds a polyhedron: each face of its core moved outwards by the radius, strips between them, and corners. */
static inline void dem_io__polyhedron(dem_io_surface *s, const dem_world *world, int index, const dem_convex *c) {
    const dem_vec x = dem_position(world, index);
    const dem_quaternion q = dem_shape_orientation(world, index);
    const int first = s->vertices;
    for (int f = 0; f < c->faces; f++) {
        const dem_vec n = dem_vec3(c->plane[f][0], c->plane[f][1], c->plane[f][2]);
        for (int k = c->face_start[f]; k < c->face_start[f + 1]; k++) {
            const double *p = c->corner[c->face_corner[k]];
            const dem_vec own = dem_io__along(dem_vec3(p[0], p[1], p[2]), c->radius, n);
            dem_io__corner(s, index, dem_io__along(x, 1.0, dem_io__turned(q, dem_io__given(c, own))));
        }
        dem_io__fan(s, first + c->face_start[f], c->face_start[f + 1] - c->face_start[f]);
    }
    for (int e = 0; e < c->edges; e++) { /* it runs with the corners of its first face */
        const int a = first + dem_io__place_in_face(c, c->edge_face[e][0], c->edge[e][0]),
                  b = first + dem_io__place_in_face(c, c->edge_face[e][0], c->edge[e][1]),
                  d = first + dem_io__place_in_face(c, c->edge_face[e][1], c->edge[e][1]),
                  g = first + dem_io__place_in_face(c, c->edge_face[e][1], c->edge[e][0]);
        dem_io__face(s, b, a, g), dem_io__face(s, b, g, d);
    }
    for (int k = 0; k < c->corners; k++) { /* from face to face around it, over the edges that end there */
        int face = 0, at, one = -1, two = -1;
        while (face < c->faces && dem_io__place_in_face(c, face, k) < 0) face++;
        for (int turns = 0, begin = face; turns < c->faces && (turns == 0 || face != begin); turns++) {
            at = dem_io__place_in_face(c, face, k);
            const int next = at + 1 < c->face_start[face + 1] ? at + 1 : c->face_start[face], to = c->face_corner[next];
            if (turns == 0) one = at;
            else if (turns > 1) dem_io__face(s, first + one, first + at, first + two);
            two = at;
            for (int e = 0; e < c->edges; e++) {
                if (!((c->edge[e][0] == k && c->edge[e][1] == to) || (c->edge[e][1] == k && c->edge[e][0] == to)))
                    continue;
                face = c->edge_face[e][0] == face ? c->edge_face[e][1] : c->edge_face[e][0];
                break;
            }
        }
    }
}

DEM_IO_API dem_status dem_io_polyhedra_of(const dem_world *world, dem_io_surface *surface) {
    double vertices = 1.0, triangles = 1.0;
    if (!surface) return DEM_BAD_ARGUMENT;
    memset(surface, 0, sizeof *surface);
    if (!world || !world->def.allocator.fn) return DEM_BAD_ARGUMENT;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        const dem_convex *c = dem_get_shape(world, dem_shape_of(world, i));
        if (!c || !dem_io__is_there(world, i)) continue;
        vertices += 2.0 * c->edges, triangles += 6.0 * c->edges - 2.0 * (c->faces + c->corners);
    }
    const dem_status status = dem_io__allot(world, vertices, triangles, surface);
    if (status != DEM_OK) return status;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        const dem_convex *c = dem_get_shape(world, dem_shape_of(world, i));
        if (c && dem_io__is_there(world, i)) dem_io__polyhedron(surface, world, (int)i, c);
    }
    return DEM_OK;
}

DEM_IO_API void dem_io_free_surface(dem_io_surface *surface) {
    if (!surface) return;
    if (surface->block) surface->allocator.fn(surface->allocator.user, surface->block, surface->bytes, 0);
    memset(surface, 0, sizeof *surface);
}

/* =================================================== >>ParaView =================================================== */

static inline void dem_io__store(double *at, dem_vec v) { at[0] = v.x, at[1] = v.y, at[2] = v.z; }

DEM_IO_API riddle_io_status dem_io_particles(const dem_world *world, const char *folder, const char *name) {
    if (!world || !world->def.allocator.fn) return RIDDLE_IO_BAD_ARGUMENT;
    const dem_allocator *a = &world->def.allocator;
    const size_t n = (size_t)world->count, bytes = n * (14 * sizeof(double) + 4 * sizeof(int)) + 8;
    double *place = (double *)a->fn(a->user, NULL, 0, bytes);
    if (!place) return RIDDLE_IO_NO_MEMORY;
    double *velocity = place + 3 * n, *spin = velocity + 3 * n, *diameter = spin + 3 * n;
    double *cosine = diameter + n, *turn = cosine + n;
    int *group = (int *)(void *)(turn + 3 * n), *material = group + n, *id = material + n, *body = id + n;
    int turned = 0;
    size_t m = 0;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        if (!dem_io__is_there(world, i)) continue;
        dem_io__store(&place[3 * m], dem_position(world, i));
        dem_io__store(&velocity[3 * m], dem_velocity(world, i));
        dem_io__store(&spin[3 * m], dem_spin(world, i));
        diameter[m] = 2.0 * dem_radius(world, i);
        group[m] = (int)world->group[i], material[m] = (int)world->material[i], id[m] = (int)(world->id[i] & INT_MAX);
        const dem_body of = dem_get_body(world, i);
        body[m] = (int)(world->id[of.first] & INT_MAX);
        dem_io__store(&turn[3 * m], dem_vec3(of.orientation.x, of.orientation.y, of.orientation.z));
        turned |= of.pieces > 1 || of.orientation.w != 1.0;
        cosine[m++] = of.orientation.w;
    }
    const riddle_io_array arrays[] = {riddle_io_scalar("diameter_m", diameter),
                                      riddle_io_vector("velocity_m_s", velocity),
                                      riddle_io_vector("spin_rad_s", spin),
                                      riddle_io_ints("group", group),
                                      riddle_io_ints("material", material),
                                      riddle_io_ints("id", id),
                                      riddle_io_ints("body", body),
                                      riddle_io_scalar("orientation_w", cosine),
                                      riddle_io_vector("orientation_xyz", turn)};
    const riddle_io_status status =
        riddle_io_points(folder, name, (int)m, riddle_io_vector("position", place), arrays, turned ? 9 : 6);
    a->fn(a->user, place, bytes, 0);
    return status;
}

/* Writes a surface that was made with a status, and frees it. */
static inline riddle_io_status dem_io__write_surface(dem_io_surface *s, dem_status made, const char *folder,
                                                     const char *name, const char *label) {
    if (made != DEM_OK) return made == DEM_OUT_OF_MEMORY ? RIDDLE_IO_NO_MEMORY : RIDDLE_IO_BAD_ARGUMENT;
    const size_t bytes = (size_t)(s->triangles + 1) * sizeof(int);
    int *ends = (int *)s->allocator.fn(s->allocator.user, NULL, 0, bytes);
    for (int k = 0; ends && k < s->triangles; k++) ends[k] = 3 * (k + 1);
    const riddle_io_array owner = riddle_io_ints(label, s->wall);
    const riddle_io_status status =
        ends ? riddle_io_polygons(folder, name, s->vertices, riddle_io_vector("position", s->vertex), s->triangles,
                                  ends, s->triangle, &owner, 1)
             : RIDDLE_IO_NO_MEMORY;
    if (ends) s->allocator.fn(s->allocator.user, ends, bytes, 0);
    dem_io_free_surface(s);
    return status;
}

DEM_IO_API riddle_io_status dem_io_walls(const dem_world *world, const char *folder, const char *name) {
    dem_io_surface s;
    const dem_status made = dem_io_surface_of(world, &s);
    return dem_io__write_surface(&s, made, folder, name, "wall");
}

DEM_IO_API riddle_io_status dem_io_polyhedra(const dem_world *world, const char *folder, const char *name) {
    dem_io_surface s;
    const dem_status made = dem_io_polyhedra_of(world, &s);
    return dem_io__write_surface(&s, made, folder, name, "particle");
}

/* Opens a part of a series. Of a name that is too long enough is left here for riddle_io_series_open to refuse it,
   with its line. */
static inline riddle_io_series *dem_io__open_part(const char *folder, const char *name, const char *ending) {
    char whole[RIDDLE_IO_SERIES_BYTES + 100];
    snprintf(whole, sizeof whole, "%.1000s%s", name, ending);
    return riddle_io_series_open(folder, whole);
}

DEM_IO_API dem_io_series dem_io_open(const char *folder, const char *name) {
    dem_io_series s = {folder, name, NULL, NULL, NULL};
    if (name && strlen(name) + strlen("_polyhedra") > RIDDLE_IO_SERIES_BYTES) { /* that part is opened later */
        dem_io__open_part(folder, name, "_polyhedra");
        return s;
    }
    s.particles = riddle_io_series_open(folder, name);
    if (s.particles) s.walls = dem_io__open_part(folder, name, "_walls");
    return s;
}

/* Writes the next frame of a part, unless a part before it failed: then it is only named, so that all count alike. */
static inline riddle_io_status
dem_io__add_part(riddle_io_series *part, riddle_io_status before, const dem_world *world, const char *folder,
                 riddle_io_status (*write)(const dem_world *, const char *, const char *)) {
    const char *name = riddle_io_series_name(part, world->time);
    const riddle_io_status status = before != RIDDLE_IO_OK ? before
                                    : name                 ? write(world, folder, name)
                                                           : RIDDLE_IO_NO_MEMORY;
    if (status != RIDDLE_IO_OK) riddle_io_series_drop(part); /* an older file of that name may be there */
    return status;
}

DEM_IO_API riddle_io_status dem_io_add(dem_io_series *series, const dem_world *world) {
    if (!series || !series->particles || !series->walls || !world) return RIDDLE_IO_BAD_ARGUMENT;
    riddle_io_status status =
        dem_io__add_part(series->particles, RIDDLE_IO_OK, world, series->folder, dem_io_particles);
    status = dem_io__add_part(series->walls, status, world, series->folder, dem_io_walls);
    if (!dem_get_shape(world, 0)) return status;
    if (!series->polyhedra) series->polyhedra = dem_io__open_part(series->folder, series->name, "_polyhedra");
    if (!series->polyhedra) return status != RIDDLE_IO_OK ? status : RIDDLE_IO_NO_MEMORY;
    return dem_io__add_part(series->polyhedra, status, world, series->folder, dem_io_polyhedra);
}

DEM_IO_API riddle_io_status dem_io_close(dem_io_series *series) {
    if (!series) return RIDDLE_IO_BAD_ARGUMENT;
    const riddle_io_status first = riddle_io_series_close(series->particles),
                           second = riddle_io_series_close(series->walls);
    const riddle_io_status third = series->polyhedra ? riddle_io_series_close(series->polyhedra) : RIDDLE_IO_OK;
    series->particles = series->walls = series->polyhedra = NULL;
    return first != RIDDLE_IO_OK ? first : second != RIDDLE_IO_OK ? second : third;
}

/* =================================================== >>sections =================================================== */

/* A plane with its own axes, in which things are drawn. */
typedef struct dem_io__view {
    dem_vec origin, normal, right, up;
} dem_io__view;

static inline int dem_io__make_view(dem_io__view *v, dem_vec point, dem_vec normal, dem_vec right) {
    const double n = sqrt(dem_io__dot(normal, normal));
    v->origin = point;
    v->normal = dem_io__along(dem_vec3(0, 0, 0), 1.0 / n, normal);
    right = dem_io__along(right, -dem_io__dot(right, v->normal), v->normal);
    const double r = sqrt(dem_io__dot(right, right));
    v->right = dem_io__along(dem_vec3(0, 0, 0), 1.0 / r, right);
    v->up = dem_io__cross(v->normal, v->right);
    return n > 0.0 && r > 1e-9 && n < 1e100 && r < 1e100 && dem_io__dot(point, point) < HUGE_VAL;
}

static inline double dem_io__height(const dem_io__view *v, dem_vec at) {
    return dem_io__dot(dem_io__along(at, -1.0, v->origin), v->normal);
}

/* Lists the spheres that the plane cuts, as x, y, r [mm]: those of a named group or, for group n_names + c, those of
   all groups without a name that have colour c. Returns their number. */
static inline int dem_io__cut_spheres(const dem_world *world, const dem_io__view *v, int group, int n_names, double *x,
                                      double *y, double *r) {
    int n = 0;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        const int g = (int)world->group[i], drawn_as = g >= 0 && g < n_names ? g : n_names + (int)((unsigned)g & 7u);
        if (drawn_as != group || !dem_io__is_there(world, i)) continue;
        const dem_vec at = dem_position(world, i);
        const double h = dem_io__height(v, at), radius = dem_radius(world, i);
        if (!(fabs(h) < radius)) continue;
        x[n] = 1e3 * dem_io__dot(at, v->right), y[n] = 1e3 * dem_io__dot(at, v->up),
        r[n] = 1e3 * sqrt(radius * radius - h * h);
        n++;
    }
    return n;
}

/* Computes the line in which the plane cuts a triangle, as two points and a gap after them; returns 3, or 0 where
   it is not cut. */
static inline int dem_io__cut_triangle(const dem_io__view *v, const dem_vec corner[3], double *x, double *y) {
    int n = 0;
    for (int k = 0; k < 3 && n < 2; k++) {
        const dem_vec a = corner[k], b = corner[(k + 1) % 3];
        const double ha = dem_io__height(v, a), hb = dem_io__height(v, b);
        if ((ha > 0.0) == (hb > 0.0)) continue;
        const dem_vec at = dem_io__along(a, ha / (ha - hb), dem_io__along(b, -1.0, a));
        x[n] = 1e3 * dem_io__dot(at, v->right), y[n] = 1e3 * dem_io__dot(at, v->up);
        n++;
    }
    if (n < 2) return 0;
    x[2] = y[2] = (double)NAN;
    return 3;
}

static inline dem_status dem_io__section_of_walls(const dem_world *world, riddle_plot *figure, const dem_io__view *v) {
    dem_io_surface s;
    dem_status status = dem_io_surface_of(world, &s);
    if (status != DEM_OK) return status;
    const size_t bytes = 6 * (size_t)(s.triangles + 1) * sizeof(double);
    double *x = (double *)s.allocator.fn(s.allocator.user, NULL, 0, bytes);
    int n = 0;
    for (int k = 0; x && k < s.triangles; k++) {
        dem_vec corner[3];
        for (int c = 0; c < 3; c++) {
            const double *at = &s.vertex[3 * (size_t)s.triangle[3 * (size_t)k + (size_t)c]];
            corner[c] = dem_vec3(at[0], at[1], at[2]);
        }
        n += dem_io__cut_triangle(v, corner, x + n, x + 3 * (size_t)(s.triangles + 1) + n);
    }
    if (x) riddle_plot_line(figure, NULL, x, x + 3 * (size_t)(s.triangles + 1), n);
    if (x) riddle_plot_style(figure, 0, RIDDLE_PLOT_BLACK);
    if (x) s.allocator.fn(s.allocator.user, x, bytes, 0);
    else status = DEM_OUT_OF_MEMORY;
    dem_io_free_surface(&s);
    return status;
}

DEM_IO_API dem_status dem_io_section(const dem_world *world, riddle_plot *figure, dem_vec point, dem_vec normal,
                                     dem_vec right, const char *const *names, int n_names) {
    dem_io__view v;
    if (!world || !world->def.allocator.fn || !figure || !dem_io__make_view(&v, point, normal, right))
        return DEM_BAD_ARGUMENT;
    const dem_allocator *a = &world->def.allocator;
    const size_t n = (size_t)world->count, bytes = 3 * (n + 1) * sizeof(double);
    double *x = (double *)a->fn(a->user, NULL, 0, bytes);
    if (!x) return DEM_OUT_OF_MEMORY;
    const int named = names && n_names > 0 ? n_names : 0;
    riddle_plot_scale_bar(figure, "mm");
    for (int k = 0; k < named + 8; k++) { /* groups may have any numbers, and be many */
        const int found = dem_io__cut_spheres(world, &v, k, named, x, x + n, x + 2 * n);
        const char *name = k < named ? names[k] : NULL;
        if (!found && !name) continue;
        riddle_plot_discs(figure, name, x, x + n, x + 2 * n, found);
        riddle_plot_style(figure, 0, k < named ? k : k - named);
    }
    a->fn(a->user, x, bytes, 0);
    return dem_io__section_of_walls(world, figure, &v);
}

#endif /* DEM_IO__BODIES */

#ifdef __cplusplus
}
#endif
#endif
