/* scene_shapes.c: see scene_shapes.h */
#include "scene_shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene_walls.h"

/* An array of negative length does not compile: the limits of the table are those of dem.h. */
typedef char limits_agree[SHAPE_SPHERES_MAX == DEM_CLUMP_MAX && SHAPE_CORNERS_MAX == DEM_CORNERS_MAX &&
                                  SHAPE_PARTS_MAX == DEM_PARTS_MAX
                              ? 1
                              : -1];

int scene_is_polyhedron(const body_shape *shape) { return shape && shape->clump.spheres == 0; }

int scene_pieces(const body_shape *shape) {
    if (!shape) return 1;
    return shape->parts ? shape->parts : shape->clump.spheres ? shape->clump.spheres : 1;
}

double scene_widest(const body_shape *shape) {
    double widest = 0.0;
    if (!shape) return 1.0;
    for (int k = 0; k < shape->clump.spheres; k++)
        widest = fmax(widest, 2.0 * shape->clump.radius[k] / shape->diameter);
    return scene_is_polyhedron(shape) ? shape->reach : widest;
}

static double diameter_of(double volume) { return 2.0 * riddle_cbrt(volume / (4.0 / 3.0 * RIDDLE_PI)); }

static int is_filled(const shape_def *d) { return d->mesh.part.where && d->mesh.spheres > 0.0; }

int scene_say_fit(const scene *s, int shape, char *line, size_t size) {
    const body_shape *b = &s->shape[shape];
    if (!is_filled(b->def)) return 0;
    snprintf(line, size,
             "shapes.%.60s: %d spheres fill %.1f %% of its volume; moments of what they fill: %.1f %% off, centre: "
             "%.1f %% of the diameter",
             b->def->part.name, b->clump.spheres, 100.0 * (1.0 + b->fit.volume), 100.0 * b->fit.moments,
             100.0 * b->fit.centre);
    return 1;
}

/* ---- making ---- */

static dem_status fill_mesh(scene *s, body_shape *b) {
    const shape_mesh *m = &b->def->mesh;
    dem_mesh mesh;
    if (scene_read_stl(s->file, fields_where(&m->part, "file"), m->file, m->unit, m->weld, &mesh))
        return DEM_BAD_ARGUMENT;
    const dem_status status = dem_make_clump_from_mesh(&mesh, (int)m->spheres, NULL, &b->clump, &b->fit);
    dem_free_mesh(&mesh);
    return status;
}

static int make_clump(scene *s, body_shape *b) {
    const shape_sphere *sphere = b->def->spheres.item;
    double centre[SHAPE_SPHERES_MAX][3], diameter[SHAPE_SPHERES_MAX], reach = 0.0;
    const int n = b->def->spheres.n;
    for (int k = 0; k < n; k++) memcpy(centre[k], sphere[k].centre, sizeof centre[k]), diameter[k] = sphere[k].diameter;
    const shape_capsule *capsule = &b->def->capsule;
    const char *key = n ? "spheres" : is_filled(b->def) ? "mesh" : "capsule";
    const dem_status status = n                   ? dem_make_clump(n, &centre[0][0], diameter, &b->clump)
                              : is_filled(b->def) ? fill_mesh(s, b)
                                                  : dem_make_capsule(&b->clump, capsule->diameter, capsule->length);
    if (status != DEM_OK)
        return tree_fail(s->file, fields_where(&b->def->part, key),
                         n                   ? "%s: %s (places or diameters too large or too small)"
                         : is_filled(b->def) ? "%s: %s (a surface that is not closed or encloses nothing)"
                                             : "%s: %s (a length below the diameter, or above 9.8 of it)",
                         key, dem_status_text(status));
    for (int k = 0; k < b->clump.spheres; k++) {
        const dem_vec x = b->clump.centre[k];
        reach = fmax(reach, sqrt(x.x * x.x + x.y * x.y + x.z * x.z) + b->clump.radius[k]);
    }
    b->diameter = dem_clump_diameter(&b->clump);
    b->reach = 2.0 * reach / b->diameter;
    return 0;
}

static dem_status make_from_mesh(scene *s, const shape_def *d, dem_convex *to, const char **reason) {
    const shape_mesh *m = &d->mesh;
    dem_mesh mesh;
    if (scene_read_stl(s->file, fields_where(&m->part, "file"), m->file, m->unit, m->weld, &mesh))
        return DEM_BAD_ARGUMENT;
    const dem_status status =
        m->hull ? dem_make_hull(to, mesh.vertices, mesh.vertex, d->rounding, m->tolerance, NULL, reason)
                : dem_make_convex_mesh(to, &mesh, d->rounding, reason);
    dem_free_mesh(&mesh);
    return status;
}

static int make_convex(scene *s, const shape_def *d, dem_convex *to) {
    const shape_tablet *t = &d->tablet;
    const shape_gravel *g = &d->gravel;
    const char *reason = "", *key = "box";
    dem_status status;
    if (d->corners.n) {
        key = "corners";
        status = dem_make_convex(to, d->corners.n, d->corners.item, d->rounding, &reason);
    } else if (d->mesh.part.where) {
        key = "mesh";
        status = make_from_mesh(s, d, to, &reason);
    } else if (t->part.where) {
        key = "tablet";
        status =
            dem_make_tablet(to, t->diameter, t->height, isnan(t->band) ? t->height : t->band, d->rounding, &reason);
    } else if (g->part.where) {
        key = "gravel";
        status = dem_make_gravel(to, g->diameter, g->elongation, g->flatness, (int)g->corners, (uint64_t)g->seed,
                                 d->rounding, &reason);
    } else status = dem_make_brick(to, scene_vec(d->box), d->rounding, &reason);
    return status == DEM_OK ? 0 : tree_fail(s->file, fields_where(&d->part, key), "%s: %s", key, reason);
}

static int make_polyhedron(scene *s, body_shape *b) {
    if (make_convex(s, b->def, &b->polyhedron)) return -1;
    b->diameter = diameter_of(b->polyhedron.volume);
    b->reach = 2.0 * b->polyhedron.reach / b->diameter;
    return 0;
}

/* The same polyhedron, all lengths times a factor. */
static dem_convex scaled(const dem_convex *original, double factor) {
    dem_convex c = *original;
    const double cube = factor * factor * factor;
    for (int k = 0; k < c.corners; k++)
        for (int a = 0; a < 3; a++) c.corner[k][a] *= factor;
    for (int k = 0; k < c.faces; k++) c.plane[k][3] *= factor;
    for (int a = 0; a < 3; a++) c.moment[a] *= cube * factor * factor;
    for (int a = 0; a < 3; a++) *dem_axis_of(&c.half, a) *= factor, *dem_axis_of(&c.centroid, a) *= factor;
    c.radius *= factor, c.reach *= factor, c.volume *= cube;
    return c;
}

/* Makes a compound of a world, all lengths times a factor. */
static dem_status add_compound(dem_world *world, const body_shape *b, double factor, dem_compound *c,
                               const char **reason) {
    double place[3 * SHAPE_PARTS_MAX];
    dem_convex *part = malloc((size_t)b->parts * sizeof *part);
    if (!part) return DEM_OUT_OF_MEMORY;
    for (int k = 0; k < b->parts; k++) part[k] = scaled(&b->part[k], factor);
    for (int k = 0; k < 3 * b->parts; k++) place[k] = factor * b->place[k];
    const dem_status status = dem_make_compound(world, b->parts, part, place, b->turn, c, reason);
    free(part);
    return status;
}

/* Volume and reach are asked of a world that has nothing else. */
static int measure_compound(scene *s, body_shape *b) {
    dem_def def = dem_default_def();
    dem_world trial;
    dem_compound c;
    const char *reason = NULL;
    double reach = 0.0;
    dem_add_material(&def, 1000.0, 1e9, 0.3);
    dem_status status = dem_init(&trial, &def, NULL);
    if (status == DEM_OK) {
        status = add_compound(&trial, b, 1.0, &c, &reason);
        for (int k = 0; k < b->parts && status == DEM_OK; k++) {
            const dem_vec x = c.centre[k];
            reach = fmax(reach, sqrt(x.x * x.x + x.y * x.y + x.z * x.z) + dem_get_shape(&trial, c.shape[k])->reach);
        }
        dem_free(&trial);
    }
    if (status != DEM_OK)
        return tree_fail(s->file, fields_where(&b->def->part, "parts"), "parts: %s",
                         reason ? reason : dem_status_text(status));
    b->diameter = diameter_of(c.volume);
    b->reach = 2.0 * reach / b->diameter;
    return 0;
}

static int make_compound(scene *s, body_shape *b) {
    const shape_def *d = b->def->parts.item;
    const size_t n = (size_t)b->def->parts.n;
    b->part = tree_memory(s->file, n * sizeof *b->part);
    b->place = tree_memory(s->file, 7 * n * sizeof *b->place);
    if (!b->part || !b->place) return -1;
    b->parts = (int)n, b->turn = b->place + 3 * n;
    for (int k = 0; k < b->parts; k++) {
        const double length =
                         sqrt(d[k].axis[0] * d[k].axis[0] + d[k].axis[1] * d[k].axis[1] + d[k].axis[2] * d[k].axis[2]),
                     half = 0.5 * d[k].angle;
        if (!(length > 0.0) || !isfinite(length))
            return tree_fail(s->file, fields_where(&d[k].part, "axis"), "axis: it has no direction");
        if (is_filled(&d[k]))
            return tree_fail(s->file, fields_where(&d[k].mesh.part, "spheres"), "spheres: a part is no clump");
        if (make_convex(s, &d[k], &b->part[k])) return -1;
        b->turn[4 * k] = riddle_cos(half);
        for (int a = 0; a < 3; a++) {
            b->turn[4 * k + 1 + a] = riddle_sin(half) * d[k].axis[a] / length;
            b->place[3 * k + a] = d[k].at[a];
        }
    }
    return measure_compound(s, b);
}

int scene_make_shapes(scene *s) {
    const shape_def *d = s->def->shapes.item;
    s->shape = tree_memory(s->file, (size_t)(s->def->shapes.n + 1) * sizeof *s->shape);
    if (!s->shape) return -1;
    for (int k = 0; k < s->def->shapes.n; k++) {
        s->shape[k].def = &d[k];
        const int clump = d[k].spheres.n || d[k].capsule.part.where || is_filled(&d[k]);
        if (clump          ? make_clump(s, &s->shape[k])
            : d[k].parts.n ? make_compound(s, &s->shape[k])
                           : make_polyhedron(s, &s->shape[k]))
            return -1;
    }
    return 0;
}

int scene_shape_of(scene *s, const feed_def *feed, const body_shape **shape) {
    const char *names[40];
    *shape = NULL;
    if (!feed->shape) return 0;
    for (int k = 0; k < s->def->shapes.n; k++) {
        names[k] = s->shape[k].def->part.name;
        if (strcmp(names[k], feed->shape) == 0) *shape = &s->shape[k];
    }
    const tree *at = fields_where(&feed->part, "shape");
    if (!*shape && s->def->shapes.n == 0)
        return tree_fail(s->file, at, "shape: no shape %.60s; the scene has no shapes", feed->shape);
    return *shape ? 0 : fields_refuse_word(s->file, at, "shape", feed->shape, names, s->def->shapes.n);
}

/* ---- in a world ---- */

/* The number of a source's polyhedron of a diameter in a world, which gets it; or minus a dem_status. */
static int add_polyhedron(dem_world *world, const source *q, double diameter) {
    const dem_convex c = scaled(&q->shape->polyhedron, diameter / q->shape->diameter);
    return dem_add_shape(world, &c);
}

/* The same for a compound. */
static dem_status add_compound_of(dem_world *world, const source *q, double diameter, dem_compound *c) {
    return add_compound(world, q->shape, diameter / q->shape->diameter, c, NULL);
}

int scene_add_shapes(scene *s) {
    for (int k = 0; k < s->sources; k++) {
        source *q = &s->source[k];
        const double diameter = q->feed->sizes.diameter[0];
        int failed = 0;
        if (!scene_is_polyhedron(q->shape)) continue;
        if (q->shape->parts) {
            q->compound = tree_memory(s->file, sizeof *q->compound);
            if (!q->compound) return -1;
            failed = (int)add_compound_of(&s->world, q, diameter, q->compound);
            q->feed->compound = q->compound;
        } else {
            const int number = add_polyhedron(&s->world, q, diameter);
            if (number < 0) failed = -number;
            else q->feed->polyhedron = number + 1;
        }
        if (failed)
            return tree_fail(s->file, q->def->part.where, "shape %.60s: %s", q->shape->def->part.name,
                             dem_status_text((dem_status)failed));
    }
    return 0;
}

int scene_has_polyhedra(const scene *s) {
    for (int k = 0; k < s->sources; k++)
        if (scene_is_polyhedron(s->source[k].shape)) return 1;
    return 0;
}

dem_status scene_put(dem_world *world, const source *q, double diameter, dem_vec centre) {
    const double at[3] = {centre.x, centre.y, centre.z};
    const int material = q->feed->material;
    if (!q->shape) return dem_add_spheres(world, 1, at, &diameter, material, 0);
    if (!scene_is_polyhedron(q->shape))
        return dem_add_clumps(world, 1, &q->shape->clump, at, &diameter, NULL, material, 0);
    if (q->shape->parts) {
        dem_compound c;
        const dem_status status = add_compound_of(world, q, diameter, &c);
        return status == DEM_OK ? dem_add_compounds(world, 1, &c, at, NULL, material, 0) : status;
    }
    const int number = add_polyhedron(world, q, diameter);
    return number < 0 ? (dem_status)-number : dem_add_convex(world, number, 1, at, NULL, material, 0);
}
