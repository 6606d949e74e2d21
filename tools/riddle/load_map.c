/* load_map.c: see load_map.h */
#include "load_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "earlier.h"

/* Of one triangle, over the time of the map. */
typedef struct load {
    double push;  /* time integral of the normal force [N s] */
    double slide; /* integral of normal force x sliding speed [J]: Archard's wear is proportional to it */
    double rub;   /* work of friction [J] */
    double hit;   /* integral of normal force x closing speed [J]: what a contact has stored comes back, what
                     hits lose stays */
} load;

typedef struct load_map {
    int wall; /* of the file */
    load *load; /* [triangles] */
    dem_vec *low, *high; /* boxes around the triangles, in the wall's frame */
} load_map;

struct load_maps {
    scene *s;
    load_map *map;
    int maps;
    double time; /* [s] */
};

static dem_vec less(dem_vec a, dem_vec b) { return dem_vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
static double times(dem_vec a, dem_vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static dem_vec across(dem_vec a, dem_vec b) {
    return dem_vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static dem_vec plus(dem_vec a, double t, dem_vec b) { return dem_vec3(a.x + t * b.x, a.y + t * b.y, a.z + t * b.z); }

static const dem_wall *wall_of(const load_maps *m, int map) {
    return &m->s->world.wall[m->s->wall_of[m->map[map].wall]];
}
static dem_vec corner_of(const dem_wall *w, int triangle, int corner) {
    return w->tree->vertex[w->tree->corner[3 * triangle + corner]];
}

static int open_map(load_maps *m, const wall_def *def, int wall) {
    load_map *map = &m->map[m->maps];
    map->wall = wall;
    const dem_wall *w = wall_of(m, m->maps);
    if (w->kind != DEM_MESH)
        return tree_fail(m->s->file, fields_where(&def->part, "load_map"),
                         "load_map: wall %.60s has no triangles: only box, lifters and mesh have", def->part.name);
    const size_t n = (size_t)w->tree->triangles;
    map->load = tree_memory(m->s->file, n * sizeof *map->load);
    map->low = tree_memory(m->s->file, n * sizeof *map->low);
    map->high = tree_memory(m->s->file, n * sizeof *map->high);
    if (!map->load || !map->low || !map->high) return -1;
    for (int k = 0; k < (int)n; k++) {
        map->low[k] = map->high[k] = corner_of(w, k, 0);
        for (int c = 1; c < 3; c++) {
            const dem_vec x = corner_of(w, k, c);
            map->low[k] = dem_vec3(fmin(map->low[k].x, x.x), fmin(map->low[k].y, x.y), fmin(map->low[k].z, x.z));
            map->high[k] = dem_vec3(fmax(map->high[k].x, x.x), fmax(map->high[k].y, x.y), fmax(map->high[k].z, x.z));
        }
    }
    m->maps++;
    return 0;
}

load_maps *load_maps_open(scene *s) {
    const wall_def *w = s->def->walls.item;
    load_maps *m = tree_memory(s->file, sizeof *m);
    if (!m) return NULL;
    m->s = s;
    m->map = tree_memory(s->file, ((size_t)s->def->walls.n + 1) * sizeof *m->map);
    for (int k = 0; m->map && k < s->def->walls.n; k++)
        if (w[k].load_map && open_map(m, &w[k], k)) return NULL;
    return m->map ? m : NULL;
}

/* Square of the distance of x from the segment p to q. */
static double from_edge(dem_vec x, dem_vec p, dem_vec q) {
    const dem_vec along = less(q, p), d = less(x, p);
    const double t = fmin(fmax(times(d, along) / times(along, along), 0.0), 1.0);
    const dem_vec off = plus(d, -t, along);
    return times(off, off);
}
static double from_triangle(dem_vec x, dem_vec a, dem_vec b, dem_vec c) {
    const dem_vec n = across(less(b, a), less(c, a)), d = less(x, a);
    const double inside[3] = {times(across(less(b, a), d), n), times(across(less(c, b), less(x, b)), n),
                              times(across(less(a, c), less(x, c)), n)};
    if (inside[0] >= 0.0 && inside[1] >= 0.0 && inside[2] >= 0.0) return times(d, n) * times(d, n) / times(n, n);
    return fmin(from_edge(x, a, b), fmin(from_edge(x, b, c), from_edge(x, c, a)));
}
static double from_box(dem_vec x, dem_vec low, dem_vec high) {
    double sum = 0.0;
    for (int c = 0; c < 3; c++) {
        const double off = fmax(fmax(dem_axis(low, c) - dem_axis(x, c), dem_axis(x, c) - dem_axis(high, c)), 0.0);
        sum += off * off;
    }
    return sum;
}

static int nearest(const load_map *map, const dem_wall *w, dem_vec place) {
    const dem_vec d = less(place, w->position),
                  x = dem_vec3(times(d, w->axis[0]), times(d, w->axis[1]), times(d, w->axis[2]));
    double least = HUGE_VAL;
    int found = 0;
    for (int k = 0; k < w->tree->triangles; k++) {
        if (!(from_box(x, map->low[k], map->high[k]) < least)) continue;
        const double far = from_triangle(x, corner_of(w, k, 0), corner_of(w, k, 1), corner_of(w, k, 2));
        if (far < least) least = far, found = k;
    }
    return found;
}

/* Velocity of the particle's surface over the wall's, at the place of the contact. A belt runs at the part of its
   velocity that is along the surface. */
static dem_vec relative(const load_maps *m, const dem_wall *w, const dem_contact_info *c) {
    const dem_world *world = &m->s->world;
    const dem_vec spin = dem_vec3(w->spin * w->spin_axis.x, w->spin * w->spin_axis.y, w->spin * w->spin_axis.z),
                  belt = plus(w->asked.belt, -times(w->asked.belt, c->normal), c->normal);
    dem_vec v = less(
        plus(dem_velocity(world, c->i), 1.0, across(dem_spin(world, c->i), less(c->point, dem_position(world, c->i)))),
        plus(w->velocity, 1.0, across(spin, less(c->point, w->position))));
    return less(v, plus(belt, 1.0, across(w->asked.belt_turn, c->normal)));
}

void load_maps_add(load_maps *m, double time) {
    const dem_world *world = &m->s->world;
    m->time += time;
    for (ptrdiff_t k = 0; m->maps > 0 && k < dem_contact_count(world); k++) {
        const dem_contact_info c = dem_get_contact(world, k);
        if (c.j >= 0 || !(c.gap < 0.0)) continue;
        int map = 0;
        while (map < m->maps && m->s->wall_of[m->map[map].wall] != -1 - c.j) map++;
        if (map == m->maps) continue;
        const dem_wall *w = wall_of(m, map);
        const double normal = times(c.force, c.normal);
        const dem_vec v = relative(m, w, &c), slip = plus(v, -times(v, c.normal), c.normal),
                      friction = plus(c.force, -normal, c.normal);
        load *l = &m->map[map].load[nearest(&m->map[map], w, c.point)];
        l->push += normal * time;
        l->slide += fmax(normal, 0.0) * sqrt(times(slip, slip)) * time;
        l->rub -= times(friction, slip) * time;
        l->hit -= normal * times(v, c.normal) * time;
    }
}

static const char csv_head[] =
    "x_m,y_m,z_m,area_m2,normal_force_N,pressure_Pa,normal_force_x_sliding_J_m2,friction_J_m2,hits_J_m2\n";

static void write_map(const load_maps *m, int number, const char *folder, void (*wrote)(void *user, const char *name),
                      void *user) {
    const load_map *map = &m->map[number];
    const dem_wall *w = wall_of(m, number);
    const int n = w->tree->triangles;
    const char *wall = ((const wall_def *)m->s->def->walls.item)[map->wall].part.name;
    double *room = malloc(3 * (size_t)n * 8 * sizeof *room), *xyz = room, *value[5];
    int *ends = malloc(4 * (size_t)n * sizeof *ends), *corners = ends + n;
    char name[80];
    if (!room || !ends) {
        common_fail("out of memory");
        free(room), free(ends);
        return;
    }
    for (int a = 0; a < 5; a++) value[a] = room + 3 * (size_t)n * (size_t)(3 + a);
    snprintf(name, sizeof name, "loads_%.60s.csv", wall);
    riddle_io_file *file = riddle_io_open(folder, name);
    riddle_io_print(file, "%s", csv_head);
    for (int k = 0; k < n; k++) {
        dem_vec x[3], middle = dem_vec3(0.0, 0.0, 0.0);
        for (int c = 0; c < 3; c++) {
            const dem_vec v = corner_of(w, k, c);
            x[c] = plus(plus(plus(w->position, v.x, w->axis[0]), v.y, w->axis[1]), v.z, w->axis[2]);
            middle = plus(middle, 1.0 / 3.0, x[c]);
        }
        const dem_vec normal = across(less(x[1], x[0]), less(x[2], x[0]));
        const double area = 0.5 * sqrt(times(normal, normal)),
                     force = m->time > 0.0 ? map->load[k].push / m->time : 0.0;
        const double row[9] = {middle.x,
                               middle.y,
                               middle.z,
                               area,
                               force,
                               force / area,
                               map->load[k].slide / area,
                               map->load[k].rub / area,
                               map->load[k].hit / area};
        riddle_io_row(file, row, 9);
        for (int c = 0; c < 3; c++) {
            const int at = 3 * k + c;
            xyz[3 * at] = x[c].x, xyz[3 * at + 1] = x[c].y, xyz[3 * at + 2] = x[c].z;
            for (int a = 0; a < 5; a++) value[a][at] = row[4 + a];
            corners[at] = at;
        }
        ends[k] = 3 * (k + 1);
    }
    if (riddle_io_close(file) == RIDDLE_IO_OK) wrote(user, name);
    const riddle_io_array arrays[5] = {
        riddle_io_scalar("normal_force_N", value[0]), riddle_io_scalar("pressure_Pa", value[1]),
        riddle_io_scalar("normal_force_x_sliding_J_m2", value[2]), riddle_io_scalar("friction_J_m2", value[3]),
        riddle_io_scalar("hits_J_m2", value[4])};
    snprintf(name, sizeof name, "loads_%.60s.vtp", wall);
    if (riddle_io_polygons(folder, name, 3 * n, riddle_io_vector("position", xyz), n, ends, corners, arrays, 5) ==
        RIDDLE_IO_OK)
        wrote(user, name);
    free(room), free(ends);
}

void load_maps_write(const load_maps *m, const char *folder, void (*wrote)(void *user, const char *name), void *user) {
    const wall_def *w = m->s->def->walls.item;
    char name[80];
    for (int k = 0; k < m->maps; k++) write_map(m, k, folder, wrote, user);
    for (int k = 0; k < m->s->def->walls.n; k++) {
        if (w[k].load_map) continue;
        snprintf(name, sizeof name, "loads_%.60s.csv", w[k].part.name);
        earlier_remove(folder, name, csv_head);
        snprintf(name, sizeof name, "loads_%.60s.vtp", w[k].part.name);
        earlier_remove(folder, name, "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\"");
    }
}

int load_maps_exchange(load_maps *m, scene_state *io) {
    state_numbers(io, &m->time, 1);
    for (int k = 0; k < m->maps && !io->failed; k++)
        for (int t = 0; t < wall_of(m, k)->tree->triangles; t++) {
            load *l = &m->map[k].load[t];
            double v[4] = {l->push, l->slide, l->rub, l->hit};
            state_numbers(io, v, 4);
            l->push = v[0], l->slide = v[1], l->rub = v[2], l->hit = v[3];
        }
    return io->failed ? -1 : 0;
}
