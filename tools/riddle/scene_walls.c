/* scene_walls.c: see scene_walls.h */
#include "scene_walls.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "input.h"

dem_vec scene_vec(const double *xyz) { return dem_vec3(xyz[0], xyz[1], xyz[2]); }

/* The number of a material that is named at a key. */
int scene_material(tree_file *file, const scene_def *def, const scene_part *at, const char *key, const char *name,
                   int *material) {
    const material_def *m = def->materials.item;
    char list[200] = "";
    for (int k = 0; k < def->materials.n; k++) {
        const size_t used = strlen(list);
        if (name && strcmp(m[k].part.name, name) == 0) return *material = k, 0;
        if (used + strlen(m[k].part.name) + 3 < sizeof list)
            snprintf(list + used, sizeof list - used, "%s%s", k ? ", " : "", m[k].part.name);
    }
    if (!name)
        return tree_fail(file, at->where, "%s: its %s is missing; there are %s", at->name ? at->name : "here", key,
                         list);
    return tree_fail(file, fields_where(at, key), "%s: no material %.60s; there are %s", key, name, list);
}

/* ---- what is turned: a rotation by angle about an axis (Rodrigues) ---- */

typedef struct turn {
    double m[3][3];
} turn;

static int make_turn(const double *axis, double angle, turn *t) {
    const double length = sqrt(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2]);
    const double c = riddle_cos(angle), s = riddle_sin(angle);
    if (!(length > 0.0) || !isfinite(length)) return -1;
    const double n[3] = {axis[0] / length, axis[1] / length, axis[2] / length};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int k = 3 - i - j;
            const double cross = i == j ? 0.0 : (i + 1) % 3 == j ? -n[k] : n[k];
            t->m[i][j] = (i == j ? c : 0.0) + (1.0 - c) * n[i] * n[j] + s * cross;
        }
    return 0;
}

static void turn_and_shift(const turn *t, const double *centre, double *x) {
    double y[3];
    for (int i = 0; i < 3; i++) y[i] = t->m[i][0] * x[0] + t->m[i][1] * x[1] + t->m[i][2] * x[2] + centre[i];
    memcpy(x, y, sizeof y);
}

/* ---- boxes ---- */

enum { OPEN_NO, OPEN_TOP, OPEN_BOTTOM, OPEN_BOTH };

/* Corners low .. high and triangles of a box; corner bits: 1 x, 2 y, 4 z. */
static void put_box(dem_mesh *m, const double *low, const double *high, int open) {
    static const int face[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    const int32_t first = (int32_t)m->vertices;
    for (int k = 0; k < 8; k++) {
        double *x = &m->vertex[3 * m->vertices++];
        for (int c = 0; c < 3; c++) x[c] = k >> c & 1 ? high[c] : low[c];
    }
    for (int f = 0; f < 6; f++) {
        if ((f == 0 && open >= OPEN_BOTTOM) || (f == 1 && (open == OPEN_TOP || open == OPEN_BOTH))) continue;
        for (int half = 0; half < 2; half++) {
            int32_t *t = &m->triangle[3 * m->triangles++];
            t[0] = first + face[f][0], t[1] = first + face[f][1 + half], t[2] = first + face[f][2 + half];
        }
    }
}

static int add_box(scene *s, int material, const box_shape *b) {
    double vertex[24], half[3], low[3];
    int32_t triangle[36];
    dem_mesh m;
    turn t;
    memset(&m, 0, sizeof m);
    m.vertex = vertex, m.triangle = triangle;
    for (int c = 0; c < 3; c++) half[c] = 0.5 * b->size[c], low[c] = -half[c];
    if (!(half[0] > 0.0 && half[1] > 0.0 && half[2] > 0.0))
        return tree_fail(s->file, fields_where(&b->part, "size"), "size: all three above 0");
    put_box(&m, low, half, b->open);
    if (make_turn(b->axis, b->angle, &t))
        return tree_fail(s->file, fields_where(&b->part, "axis"), "axis: it has no direction");
    for (int k = 0; k < 8; k++) turn_and_shift(&t, b->centre, &vertex[3 * k]);
    return dem_add_mesh(&s->world, material, &m);
}

/* Each lifter is a box at the drum's right, tilted about its own middle, then turned to its place; the drum's axis is y
   until the end. */
static int add_lifters(scene *s, int material, const lifters_shape *l) {
    const double y[3] = {0, 1, 0}, none[3] = {0, 0, 0}, middle[3] = {l->radius - 0.5 * l->height, 0, 0};
    const double half[3] = {0.5 * l->height, 0.5 * l->length, 0.5 * l->thickness},
                 low[3] = {-half[0], -half[1], -half[2]};
    const double length = sqrt(l->axis[0] * l->axis[0] + l->axis[1] * l->axis[1] + l->axis[2] * l->axis[2]);
    const size_t n = (size_t)l->count;
    turn tilt, place, stand;
    dem_mesh m;
    if (!(l->height < l->radius))
        return tree_fail(s->file, fields_where(&l->part, "height"), "height: below the radius");
    if (!(length > 0.0)) return tree_fail(s->file, fields_where(&l->part, "axis"), "axis: it has no direction");
    /* y x axis: the line about which y turns into the axis */
    const double over[3] = {l->axis[2] / length, 0, -l->axis[0] / length};
    const double sine = sqrt(over[0] * over[0] + over[2] * over[2]), cosine = l->axis[1] / length, x[3] = {1, 0, 0};
    memset(&m, 0, sizeof m);
    m.vertex = tree_memory(s->file, 24 * n * sizeof *m.vertex);
    m.triangle = tree_memory(s->file, 36 * n * sizeof *m.triangle);
    if (!m.vertex || !m.triangle) return -1;
    make_turn(y, l->tilt, &tilt);
    make_turn(sine > 1e-12 ? over : x, riddle_atan2(sine, cosine), &stand);
    for (size_t k = 0; k < n; k++) {
        make_turn(y, l->first + 2.0 * RIDDLE_PI * (double)k / (double)n, &place);
        put_box(&m, low, half, OPEN_NO);
        for (size_t v = 8 * k; v < 8 * k + 8; v++) {
            turn_and_shift(&tilt, middle, &m.vertex[3 * v]);
            turn_and_shift(&place, none, &m.vertex[3 * v]);
            turn_and_shift(&stand, l->centre, &m.vertex[3 * v]);
        }
    }
    return dem_add_mesh(&s->world, material, &m);
}

static void box_of(const dem_mesh *m, double *low, double *high) {
    for (int c = 0; c < 3; c++) low[c] = HUGE_VAL, high[c] = -HUGE_VAL;
    for (ptrdiff_t k = 0; k < 3 * m->vertices; k++)
        low[k % 3] = fmin(low[k % 3], m->vertex[k]), high[k % 3] = fmax(high[k % 3], m->vertex[k]);
}

/* Holes, or corners that differ by rounding? A reading that makes one of corners near each other tells. */
static void note_open_edges(tree_file *file, const tree *at, const char *path, double unit, const dem_mesh *mesh,
                            const dem_stl_report *found) {
    char message[300];
    double low[3], high[3], weld = 0.0;
    size_t size;
    dem_mesh welded;
    dem_stl_report again;
    box_of(mesh, low, high);
    for (int c = 0; c < 3; c++) weld = fmax(weld, 1e-5 * (high[c] - low[c]));
    char *bytes = input_read(path, &size, message, sizeof message);
    const int read = bytes && dem_read_stl(bytes, size, unit, weld, NULL, &welded, &again) == DEM_OK;
    free(bytes);
    if (read && again.open_edges < found->open_edges)
        tree_note(
            file, at,
            "file: %s: open edges: %.0f; with weld: %.2g mm, which makes one of corners that differ by rounding: %.0f",
            path, (double)found->open_edges, 1e3 * weld, (double)again.open_edges);
    else tree_note(file, at, "file: %s: open edges: %.0f, the rims of holes", path, (double)found->open_edges);
    if (read) dem_free_mesh(&welded);
}

int scene_read_stl(tree_file *file, const tree *at, const char *name, double unit, double weld, dem_mesh *mesh) {
    char path[1000], message[300];
    size_t size;
    char *bytes = input_read(tree_beside(file, name, path, sizeof path), &size, message, sizeof message);
    if (!bytes) return tree_fail(file, at, "file: %s", message);
    dem_stl_report found;
    const dem_status status = dem_read_stl(bytes, size, unit, weld, NULL, mesh, &found);
    const char *dot = strrchr(name, '.');
    free(bytes);
    if (status == DEM_BAD_DATA && dot && strcmp(dot, ".stl") != 0 && strcmp(dot, ".STL") != 0)
        return tree_fail(file, at, "file: %s: no STL, which alone is read: save it as STL", path);
    if (status != DEM_OK && status != DEM_BAD_DATA)
        return tree_fail(file, at, "file: %s: %s", path, dem_status_text(status));
    if (found.missing > 0 || found.not_finite > 0) {
        dem_free_mesh(mesh);
        return found.missing > 0
                   ? tree_fail(file, at,
                               "file: %s: cut off or damaged: %.0f of its triangles are there, %.0f or more are not",
                               path, (double)found.facets, (double)found.missing)
                   : tree_fail(file, at, "file: %s: triangles with corners that are no finite numbers: %.0f", path,
                               (double)found.not_finite);
    }
    if (status == DEM_BAD_DATA)
        return tree_fail(file, at, "file: %s: no triangle in it: empty, damaged, or no STL", path);
    double low[3], high[3];
    box_of(mesh, low, high);
    tree_note(
        file, at,
        "file: %s: %.0f triangles in a box of %.4g x %.4g x %.4g mm, from (%.4g, %.4g, %.4g) to (%.4g, %.4g, %.4g) mm",
        path, (double)mesh->triangles, 1e3 * (high[0] - low[0]), 1e3 * (high[1] - low[1]), 1e3 * (high[2] - low[2]),
        1e3 * low[0], 1e3 * low[1], 1e3 * low[2], 1e3 * high[0], 1e3 * high[1], 1e3 * high[2]);
    if (found.open_edges > 0) note_open_edges(file, at, path, unit, mesh, &found);
    return 0;
}

static int add_mesh(scene *s, int material, const mesh_shape *shape) {
    dem_mesh m;
    turn t;
    if (make_turn(shape->axis, shape->angle, &t))
        return tree_fail(s->file, fields_where(&shape->part, "axis"), "axis: it has no direction");
    if (scene_read_stl(s->file, fields_where(&shape->part, "file"), shape->file, shape->unit, shape->weld, &m))
        return -1;
    for (ptrdiff_t k = 0; k < m.vertices; k++) turn_and_shift(&t, shape->centre, &m.vertex[3 * k]);
    const int wall = dem_add_mesh(&s->world, material, &m);
    dem_free_mesh(&m);
    return wall;
}

static int add_disc(scene *s, int material, const disc_shape *shape) {
    dem_disc disc = dem_default_disc();
    disc.centre = scene_vec(shape->centre), disc.normal = scene_vec(shape->normal);
    disc.radius = shape->radius, disc.hole_radius = shape->hole_radius;
    if (!(shape->hole_radius < shape->radius))
        return tree_fail(s->file, fields_where(&shape->part, "hole_radius"), "hole_radius: less than radius");
    return dem_add_disc(&s->world, material, &disc);
}

static int add_screen(scene *s, int material, const screen_shape *shape) {
    dem_screen screen = dem_default_screen();
    screen.aperture = shape->aperture, screen.wire = shape->wire;
    screen.profile = shape->profile == 0 ? DEM_ROUND : DEM_SEMICIRCLE;
    screen.circular = !isnan(shape->radius);
    screen.half_x = screen.circular ? shape->radius : 0.5 * shape->length;
    screen.half_y = isnan(shape->width) ? screen.half_x : 0.5 * shape->width;
    screen.centre = scene_vec(shape->centre), screen.normal = scene_vec(shape->normal),
    screen.direction = scene_vec(shape->direction);
    return dem_add_screen(&s->world, material, &screen);
}

/* ---- a wall ---- */

/* The wall's index; or minus a dem_status, or a message in the file. */
static int add_shape(scene *s, const wall_def *w, int material) {
    dem_world *world = &s->world;
    if (w->plane.part.where)
        return dem_add_plane(world, material, scene_vec(w->plane.point), scene_vec(w->plane.normal));
    if (w->exit.part.where) return dem_add_exit(world, scene_vec(w->exit.point), scene_vec(w->exit.normal));
    if (w->box.part.where) return add_box(s, material, &w->box);
    if (w->cylinder.part.where)
        return dem_add_cylinder(world, material, scene_vec(w->cylinder.point), scene_vec(w->cylinder.axis),
                                w->cylinder.radius, w->cylinder.side);
    if (w->sphere.part.where)
        return dem_add_sphere_wall(world, material, scene_vec(w->sphere.centre), w->sphere.radius, w->sphere.side);
    if (w->disc.part.where) return add_disc(s, material, &w->disc);
    if (w->screen.part.where) return add_screen(s, material, &w->screen);
    if (w->mesh.part.where) return add_mesh(s, material, &w->mesh);
    if (w->lifters.part.where) return add_lifters(s, material, &w->lifters);
    dem_cone cone;
    cone.low = scene_vec(w->cone.low), cone.high = scene_vec(w->cone.high);
    cone.low_radius = w->cone.low_radius, cone.high_radius = w->cone.high_radius;
    return dem_add_cone(world, material, &cone);
}

dem_status scene_set_belt(scene *s, const wall_def *w, int wall, double factor) {
    const belt_motion *b = &w->belt;
    if (isnan(b->velocity[0])) return dem_turn_belt(&s->world, wall, scene_vec(b->axis), factor * b->speed);
    return dem_set_belt(&s->world, wall,
                        dem_vec3(factor * b->velocity[0], factor * b->velocity[1], factor * b->velocity[2]));
}

static int move_wall(scene *s, const wall_def *w, int wall) {
    dem_world *world = &s->world;
    const scene_part *at = &w->part;
    dem_status status = DEM_OK;
    const int timed = w->timetable.n > 0; /* scene_set_timetables moves it */
    if (w->vibrate.part.where && !timed) {
        at = &w->vibrate.part;
        status = dem_vibrate(world, wall, scene_vec(w->vibrate.amplitude), scene_vec(w->vibrate.phase),
                             w->vibrate.frequency);
    }
    if (status == DEM_OK && w->rotate.part.where && !timed) {
        at = &w->rotate.part;
        status = dem_rotate(world, wall, scene_vec(w->rotate.centre), scene_vec(w->rotate.axis), w->rotate.speed);
    }
    if (status == DEM_OK && w->move.part.where && !timed)
        at = &w->move.part, status = dem_move(world, wall, scene_vec(w->move.velocity));
    if (status == DEM_OK && w->belt.part.where) {
        at = &w->belt.part;
        if (!isnan(w->belt.axis[0]) != !isnan(w->belt.speed) || !isnan(w->belt.axis[0]) == !isnan(w->belt.velocity[0]))
            return tree_fail(s->file, at->where, "belt: velocity, or axis and speed");
        status = scene_set_belt(s, w, wall, 1.0);
    }
    if (status == DEM_OK && w->piston.part.where) {
        at = &w->piston.part;
        status = dem_control_force(world, wall, scene_vec(w->piston.axis), w->piston.mass, w->piston.force,
                                   w->piston.damping);
    }
    if (status == DEM_OK && w->rotor.part.where) {
        at = &w->rotor.part;
        status = dem_control_torque(world, wall, scene_vec(w->rotor.centre), scene_vec(w->rotor.axis), w->rotor.inertia,
                                    w->rotor.torque, w->rotor.damping);
    }
    return status == DEM_OK ? 0
                            : tree_fail(s->file, at->where, "wall %.60s: %s", w->part.name, dem_status_text(status));
}

static int add_wall(scene *s, int number) {
    const wall_def *w = (const wall_def *)s->def->walls.item + number;
    const int moves = w->vibrate.part.where || w->rotate.part.where || w->move.part.where;
    int material = 0;
    if (!w->exit.part.where && scene_material(s->file, s->def, &w->part, "material", w->material, &material)) return -1;
    if (w->exit.part.where && w->material)
        return tree_fail(s->file, fields_where(&w->part, "material"), "material: an exit has none");
    if ((w->piston.part.where || w->rotor.part.where) && (moves || (w->piston.part.where && w->rotor.part.where)))
        return tree_fail(s->file, w->part.where, "wall %.60s: what a force or torque moves has no other motion",
                         w->part.name);
    if (!isnan(w->until) && !(w->until > w->from))
        return tree_fail(s->file, fields_where(&w->part, "until"), "until: after from");
    const int wall = add_shape(s, w, material);
    if (s->file->message[0]) return -1;
    if (wall < 0)
        return tree_fail(s->file, w->part.where, "wall %.60s: %s (a direction of length 0, or a size that cannot be)",
                         w->part.name, dem_status_text((dem_status)-wall));
    s->wall_of[number] = wall;
    return move_wall(s, w, wall);
}

/* Screens come first, as the books of the liquid want decks side by side (dem_wet.h). */
int scene_add_walls(scene *s) {
    const wall_def *w = s->def->walls.item;
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < s->def->walls.n; k++)
            if ((w[k].screen.part.where == NULL) == (pass == 1) && add_wall(s, k)) return -1;
    return 0;
}
