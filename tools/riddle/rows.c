/* rows.c: see rows.h */
#include "rows.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "heap_slope.h"
#include "scene_books.h"
#include "scene_feed.h"
#include "scene_laws.h"
#include "scene_shapes.h"
#include "scene_walls.h"
#include "scene_wet.h"

enum { OF_REGION = 8, MOST_CELLS = 1000000 };

/* Sums at the row before, of each wall of the world. */
struct rows_before {
    dem_vec impulse[DEM_WALLS_MAX], turned[DEM_WALLS_MAX];                 /* [N s], [N m s] */
    double work[DEM_WALLS_MAX], taken[DEM_WALLS_MAX], aged[DEM_WALLS_MAX]; /* [J], [kg], [kg s] */
};

/* ---- walls ---- */

int rows_is_exit(const scene *s, int wall) { return s->world.wall[s->wall_of[wall]].kind == DEM_EXIT; }
static const wall_def *wall_def_of(const scene *s, int wall) { return (const wall_def *)s->def->walls.item + wall; }
int rows_turns(const scene *s, int wall) {
    const wall_def *w = wall_def_of(s, wall);
    return !rows_is_exit(s, wall) && (w->rotate.part.where || w->rotor.part.where);
}
int rows_moves(const scene *s, int wall) {
    const wall_def *w = wall_def_of(s, wall);
    return !rows_is_exit(s, wall) && (rows_turns(s, wall) || w->vibrate.part.where || w->move.part.where ||
                                      w->belt.part.where || w->piston.part.where);
}
void rows_axis(const scene *s, int wall, dem_vec *point, dem_vec *axis) {
    const wall_def *w = wall_def_of(s, wall);
    const dem_vec a = scene_vec(w->rotate.part.where ? w->rotate.axis : w->rotor.axis);
    const double length = sqrt(a.x * a.x + a.y * a.y + a.z * a.z);
    *point = scene_vec(w->rotate.part.where ? w->rotate.centre : w->rotor.centre);
    *axis = dem_vec3(a.x / length, a.y / length, a.z / length);
}

/* ---- columns ---- */

static void add(row_table *r, row_kind kind, const tree *where, const char *format, ...) COMMON_PRINTF(4, 5);
static void add(row_table *r, row_kind kind, const tree *where, const char *format, ...) {
    va_list arguments;
    row_column *c = &r->column[r->columns++];
    va_start(arguments, format);
    vsnprintf(c->name, sizeof c->name, format, arguments);
    va_end(arguments);
    c->kind = kind, c->where = where;
}

static const char *const of_region[OF_REGION] = {"count",  "mass_kg", "solid_fraction", "coordination",
                                                 "vx_m_s", "vy_m_s",  "vz_m_s",         "pressure_Pa"};

static void name_wall(row_table *r, int k) {
    const wall_def *w = wall_def_of(r->s, k);
    const tree *at = w->part.where;
    const char *name = w->part.name;
    if (rows_is_exit(r->s, k)) {
        add(r, ROW_TAKEN, at, "%.60s_kg", name);
        add(r, ROW_VALUE, at, "%.60s_kg_s", name);
        add(r, ROW_VALUE, at, "%.60s_residence_s", name);
        for (int g = 0; g < r->s->groups && r->s->def->measure.by_class; g++)
            add(r, ROW_CLASS, at, "%.40s_%.48s_kg", name, r->s->group[g].name);
        return;
    }
    for (int c = 0; c < 3; c++) add(r, ROW_VALUE, at, "%.60s_F%c_N", name, "xyz"[c]);
    if (rows_turns(r->s, k)) add(r, ROW_VALUE, at, "%.60s_torque_N_m", name);
    if (rows_moves(r->s, k)) add(r, ROW_VALUE, at, "%.60s_power_W", name), r->powered = 1;
}

static void name_columns(row_table *r) {
    static const char *const fixed[ROWS_LEFT_FROM] = {"time_s",          "particles",  "mass_kg",    "kinetic_J",
                                                      "largest_overlap", "centre_x_m", "centre_y_m", "centre_z_m"};
    const scene *s = r->s;
    const scene_def *def = s->def;
    const measured_region *m = def->measure.regions.item;
    const mixing_def *x = def->measure.mixing.item;
    const heap_def *h = def->measure.heaps.item;
    for (int k = 0; k < ROWS_LEFT_FROM; k++) add(r, ROW_VALUE, def->part.where, "%s", fixed[k]);
    for (int g = 0; g < s->groups; g++) {
        const tree *at = def->part.where;
        for (int k = s->sources - 1; k >= 0; k--)
            if (s->source[k].group == g) at = s->source[k].def->part.where;
        add(r, ROW_VALUE, at, "left_%s", s->group[g].name);
    }
    for (int k = 0; k < def->walls.n; k++) name_wall(r, k);
    if (r->powered) add(r, ROW_VALUE, def->part.where, "power_W");
    for (int k = 0; k < def->measure.regions.n; k++) {
        for (int c = 0; c < OF_REGION; c++)
            add(r, ROW_VALUE, m[k].part.where, "%.60s_%s", m[k].part.name, of_region[c]);
        for (int g = 0; g < s->groups && def->measure.by_class; g++)
            add(r, ROW_CLASS, m[k].part.where, "%.40s_%.48s_kg", m[k].part.name, s->group[g].name);
    }
    r->mixing_from = r->columns;
    for (int k = 0; k < def->measure.mixing.n; k++) add(r, ROW_VALUE, x[k].part.where, "%.60s_lacey", x[k].part.name);
    r->heaps_from = r->columns;
    for (int k = 0; k < def->measure.heaps.n; k++)
        add(r, ROW_VALUE, h[k].part.where, "%.60s_angle_deg", h[k].part.name);
    if (s->wet) add(r, ROW_VALUE, def->part.where, "bridges"), add(r, ROW_VALUE, def->part.where, "liquid_kg");
    if (scene_has_polyhedra(s)) add(r, ROW_VALUE, def->part.where, "core_overlaps");
    if (def->law == LAW_BONDS) add(r, ROW_VALUE, def->part.where, "bonds");
}

static int check_columns(row_table *r) {
    for (int c = 0; c < r->columns; c++)
        for (int d = 0; d < c; d++)
            if (strcmp(r->column[c].name, r->column[d].name) == 0)
                return tree_fail(r->s->file, r->column[c].where,
                                 "two columns would have the name %.90s: another name, or label, tells them apart",
                                 r->column[c].name);
    return 0;
}

int rows_column(const row_table *r, const char *name) {
    for (int c = 0; c < r->columns; c++)
        if (strcmp(r->column[c].name, name) == 0) return c;
    return -1;
}

/* ---- what is measured by regions, cells, heaps ---- */

static int check_mixing(row_table *r, const mixing_def *m) {
    const scene *s = r->s;
    double cells = 1.0;
    const char *names[100];
    int n = 0;
    for (int c = 0; c < 3; c++) {
        if (!(m->cells[c] >= 1.0 && m->cells[c] == floor(m->cells[c])))
            return tree_fail(s->file, fields_where(&m->part, "cells"),
                             "cells: three whole numbers from 1 on are wanted");
        if (!(m->box.low[c] < m->box.high[c]))
            return tree_fail(s->file, fields_where(&m->part, "box"), "box: low must be below high along %c", "xyz"[c]);
        cells *= m->cells[c];
    }
    if (!(cells <= MOST_CELLS))
        return tree_fail(s->file, fields_where(&m->part, "cells"), "cells: more than %d", MOST_CELLS);
    for (int g = 0; g < s->groups; g++) {
        if (scene_named(m->of, s->group[g].name)) return 0;
        if (n < 100) names[n++] = s->group[g].name;
    }
    return fields_refuse_word(s->file, fields_where(&m->part, "of"), "class", m->of, names, n);
}

static int open_measures(row_table *r) {
    const scene *s = r->s;
    const measure_def *def = &s->def->measure;
    const measured_region *m = def->regions.item;
    const mixing_def *x = def->mixing.item;
    const double *g = s->def->gravity;
    double most = 0.0;
    for (int k = 0; k < def->regions.n; k++)
        if (scene_region(s->file, &m[k].region, &r->region[k])) return -1;
    for (int k = 0; k < def->mixing.n; k++) {
        if (check_mixing(r, &x[k])) return -1;
        most = fmax(most, x[k].cells[0] * x[k].cells[1] * x[k].cells[2]);
    }
    r->of_all = tree_memory(s->file, (size_t)(most + 1.0) * 3 * sizeof(double));
    if (!r->of_all) return -1;
    r->of_group = r->of_all + (size_t)most;
    if (def->heaps.n > 0 && !(g[0] * g[0] + g[1] * g[1] + g[2] * g[2] > 0.0))
        return tree_fail(s->file, def->part.where, "heaps: without gravity there is no slope");
    return 0;
}

int rows_open(row_table *r, scene *s) {
    const measure_def *m = &s->def->measure;
    memset(r, 0, sizeof *r);
    r->s = s;
    for (int k = 0; k < s->sources; k++) r->bodies |= s->source[k].shape != NULL;
    const size_t classes = (size_t)s->groups;
    const size_t most = ROWS_LEFT_FROM + 5 + classes + (5 + classes) * DEM_WALLS_MAX +
                        (OF_REGION + classes) * (size_t)m->regions.n + (size_t)(m->mixing.n + m->heaps.n);
    r->column = tree_memory(s->file, most * sizeof *r->column);
    r->region = tree_memory(s->file, ((size_t)m->regions.n + 1) * sizeof *r->region);
    r->before = tree_memory(s->file, sizeof *r->before);
    if (!r->column || !r->region || !r->before) return -1;
    name_columns(r);
    return check_columns(r) || open_measures(r) ? -1 : 0;
}

void rows_free(row_table *r) {
    free(r->value);
    r->value = NULL;
}

static double *add_region(const row_table *r, int number, double *at) {
    const scene *s = r->s;
    dem_measure m;
    if (dem_measure_region(&s->world, &r->region[number], &m) != DEM_OK) memset(&m, 0, sizeof m);
    double pressure = 0.0;
    for (int c = 0; c < 3; c++) pressure += (m.contact_stress[c][c] + m.kinetic_stress[c][c]) / 3.0;
    const double line[OF_REGION] = {(double)m.count, m.mass,       m.solid_fraction, m.coordination,
                                    m.velocity.x,    m.velocity.y, m.velocity.z,     pressure};
    memcpy(at, line, sizeof line);
    at += OF_REGION;
    if (!s->def->measure.by_class) return at;
    for (int g = 0; g < s->groups; g++) at[g] = 0.0;
    for (ptrdiff_t i = 0; i < s->world.count; i++) {
        if (!s->world.alive[i]) continue;
        const dem_body body = dem_get_body(&s->world, i);
        if (body.first == i && dem_region_holds(&r->region[number], body.position)) at[s->world.group[i]] += body.mass;
    }
    return at + s->groups;
}

static double lacey_of(const row_table *r, const mixing_def *m) {
    const scene *s = r->s;
    const dem_cells cells = {scene_vec(m->box.low),
                             scene_vec(m->box.high),
                             {(int)m->cells[0], (int)m->cells[1], (int)m->cells[2]},
                             {0.0, 0.0, 0.0}};
    const ptrdiff_t n = (ptrdiff_t)cells.n[0] * cells.n[1] * cells.n[2];
    double *sum = r->of_group, *one = r->of_group + n;
    for (ptrdiff_t k = 0; k < n; k++) sum[k] = 0.0;
    for (int g = 0; g < s->groups; g++) {
        if (!scene_named(m->of, s->group[g].name)) continue;
        if (dem_count_in_cells(&s->world, &cells, g, one, r->of_all) != DEM_OK) return (double)NAN;
        for (ptrdiff_t k = 0; k < n; k++) sum[k] += one[k];
    }
    return dem_mixing_of(n, sum, r->of_all).lacey;
}

static double slope_of(const row_table *r, const heap_def *h) {
    const dem_vec g = scene_vec(r->s->def->gravity);
    const double pull = sqrt(g.x * g.x + g.y * g.y + g.z * g.z);
    const heap_slope slope = heap_slope_of(&r->s->world, scene_vec(h->centre),
                                           dem_vec3(-g.x / pull, -g.y / pull, -g.z / pull), h->radius, HUGE_VAL);
    return slope.rings >= 4 ? slope.angle * 180.0 / RIDDLE_PI : (double)NAN;
}

/* ---- a row ---- */

/* Both sums have their own rounding: 1e-12 is nothing. */
static double left_of(const size_group *g) {
    const double left = 1.0 - g->passed / g->fed; /* NaN before anything is fed */
    return left < 1e-12 ? 0.0 : left;
}

static double diameter_of(const dem_world *world, ptrdiff_t i) {
    return dem_shape_of(world, i) >= 0 ? dem_get_body(world, i).diameter : 2.0 * dem_radius(world, i);
}

/* Of all contacts that are there now, over the smaller particle's diameter; of a clump that of its spheres, of a
   polyhedron that of the sphere of its volume. */
static double largest_overlap(const dem_world *world) {
    double largest = 0.0;
    for (ptrdiff_t k = 0; k < dem_contact_count(world); k++) {
        const dem_contact_info c = dem_get_contact(world, k);
        if (!(c.gap < 0.0)) continue;
        double smaller = diameter_of(world, c.i);
        if (c.j >= 0) smaller = fmin(smaller, diameter_of(world, c.j));
        largest = fmax(largest, -c.gap / smaller);
    }
    return largest;
}

/* Numbers of the particles present, and the centre of their mass. */
static double *add_particles(const row_table *r, double *at) {
    const dem_world *w = &r->s->world;
    double count = 0.0, mass = 0.0, x[3] = {0.0, 0.0, 0.0};
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        const dem_body body = dem_get_body(w, i);
        if (r->bodies && body.first != i) continue;
        count += 1.0, mass += body.mass;
        for (int c = 0; c < 3; c++) x[c] += body.mass * dem_axis(body.position, c);
    }
    const dem_energy_ledger energy = dem_energy(w);
    *at++ = count, *at++ = mass, *at++ = energy.kinetic + energy.rotational, *at++ = largest_overlap(w);
    for (int c = 0; c < 3; c++) *at++ = x[c] / mass;
    return at;
}

static double *add_exit(const row_table *r, int wall, double passed, double *at) {
    const scene *s = r->s;
    struct rows_before *b = r->before;
    double taken = 0.0, aged = 0.0;
    for (int g = 0; g < s->groups; g++) taken += scene_left(s, wall, g)->mass, aged += scene_left(s, wall, g)->aged;
    *at++ = s->exit_mass[wall];
    *at++ = passed > 0.0 ? (taken - b->taken[wall]) / passed : (double)NAN;
    *at++ = taken > b->taken[wall] ? (aged - b->aged[wall]) / (taken - b->taken[wall]) : (double)NAN;
    b->taken[wall] = taken, b->aged[wall] = aged;
    for (int g = 0; g < s->groups && s->def->measure.by_class; g++) *at++ = scene_left(s, wall, g)->mass;
    return at;
}

static double *add_wall(const row_table *r, int number, double passed, double *power, double *at) {
    const scene *s = r->s;
    const int wall = s->wall_of[number];
    const dem_wall *w = &s->world.wall[wall];
    struct rows_before *b = r->before;
    const double none = (double)NAN;
    if (rows_is_exit(s, number)) return add_exit(r, wall, passed, at);
    for (int c = 0; c < 3; c++)
        *at++ = passed > 0.0 ? (dem_axis(w->impulse, c) - dem_axis(b->impulse[wall], c)) / passed : none;
    if (rows_turns(s, number)) {
        dem_vec point, axis;
        rows_axis(s, number, &point, &axis);
        const dem_vec now = dem_wall_angular_impulse(&s->world, wall, point), was = b->turned[wall];
        *at++ = passed > 0.0 ? ((now.x - was.x) * axis.x + (now.y - was.y) * axis.y + (now.z - was.z) * axis.z) / passed
                             : none;
        b->turned[wall] = now;
    }
    if (rows_moves(s, number)) {
        *at++ = passed > 0.0 ? (w->work - b->work[wall]) / passed : none;
        *power += at[-1];
    }
    b->impulse[wall] = w->impulse, b->work[wall] = w->work;
    return at;
}

/* Room for one more row; 0, or -1. */
static int make_room(row_table *r) {
    if (r->n < r->room) return 0;
    const int wanted = 2 * r->room + 64;
    double *more = realloc(r->value, (size_t)wanted * (size_t)r->columns * sizeof *more);
    if (!more) return common_fail("out of memory");
    r->value = more, r->room = wanted;
    return 0;
}

int rows_measure(row_table *r) {
    const scene *s = r->s;
    const measure_def *m = &s->def->measure;
    const double now = scene_time(s), passed = now - r->looked;
    double power = 0.0;
    if (make_room(r)) return -1;
    double *at = r->value + (size_t)r->n++ * (size_t)r->columns;
    *at++ = now;
    at = add_particles(r, at);
    for (int g = 0; g < s->groups; g++) *at++ = left_of(&s->group[g]);
    for (int k = 0; k < s->def->walls.n; k++) at = add_wall(r, k, passed, &power, at);
    if (r->powered) *at++ = power;
    for (int k = 0; k < m->regions.n; k++) at = add_region(r, k, at);
    for (int k = 0; k < m->mixing.n; k++) *at++ = lacey_of(r, (const mixing_def *)m->mixing.item + k);
    for (int k = 0; k < m->heaps.n; k++) *at++ = slope_of(r, (const heap_def *)m->heaps.item + k);
    if (s->wet) {
        int bridges;
        const double volume = scene_wet_total(s, &bridges);
        *at++ = bridges, *at++ = volume * s->def->liquid.density;
    }
    if (scene_has_polyhedra(s)) *at++ = (double)dem_core_overlaps(&s->world);
    if (s->def->law == LAW_BONDS) *at++ = scene_laws_bonds(s);
    r->looked = now;
    return 0;
}

/* ---- saving ---- */

int rows_exchange(row_table *r, scene_state *io) {
    struct rows_before *b = r->before;
    double counts[2] = {r->n, r->looked};
    state_same(io, r->columns);
    state_numbers(io, counts, 2);
    if (io->failed || !(counts[0] >= 0.0 && counts[0] < 1e9)) return io->failed = 1, -1;
    if (io->reading) r->n = 0, r->looked = counts[1];
    while (r->n < (int)counts[0] && !io->failed) { /* as many as the save really holds */
        if (make_room(r)) return io->failed = 1, -1;
        state_numbers(io, r->value + (size_t)r->n++ * (size_t)r->columns, (size_t)r->columns);
    }
    for (int k = 0; !io->reading && k < r->n; k++)
        state_numbers(io, r->value + (size_t)k * (size_t)r->columns, (size_t)r->columns);
    for (int k = 0; k < DEM_WALLS_MAX; k++) {
        double v[9] = {b->impulse[k].x, b->impulse[k].y, b->impulse[k].z, b->turned[k].x, b->turned[k].y,
                       b->turned[k].z,  b->work[k],      b->taken[k],     b->aged[k]};
        state_numbers(io, v, 9);
        b->impulse[k] = dem_vec3(v[0], v[1], v[2]), b->turned[k] = dem_vec3(v[3], v[4], v[5]);
        b->work[k] = v[6], b->taken[k] = v[7], b->aged[k] = v[8];
    }
    return io->failed ? -1 : 0;
}
