/* report.c: see report.h */
#include "report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "world_picture.h"
#include "scene_feed.h"
#include "scene_shapes.h"
#include "scene_wet.h"
#include "steady.h"

enum { NAME = 96, FIXED = 5, OVERLAP = 4, OF_REGION = 8, CURVES = 8, FRAMES_A_SECOND = 25 };

struct report {
    scene *s;
    const char *folder;
    char (*column)[NAME];
    double *row; /* [rows][columns] */
    int columns, rows, room;
    dem_region *region;
    dem_vec impulse[DEM_WALLS_MAX]; /* at the last row [N s] */
    double looked;                  /* time of it [s] */
    double *frame;                  /* times of the frames [s] */
    int frames, frame_room;
    double next_frame; /* is due at this number of intervals */
    dem_io_series series;
    picture_def look;
    world_movie film;
    int filmed, drawn, pictured; /* pictured: and it is there */
    char written[60];
    int bodies; /* 1: a particle may have several spheres */
};

/* ---- columns ---- */

static int is_exit(const report *r, int wall) { return r->s->world.wall[r->s->wall_of[wall]].kind == DEM_EXIT; }

static const char *const of_region[OF_REGION] = {"count",  "mass_kg", "solid_fraction", "coordination",
                                                 "vx_m_s", "vy_m_s",  "vz_m_s",         "pressure_Pa"};

static void name_columns(report *r) {
    static const char *const fixed[FIXED] = {"time_s", "particles", "mass_kg", "kinetic_J", "largest_overlap"};
    const scene_def *def = r->s->def;
    const wall_def *w = def->walls.item;
    const measured_region *m = def->measure.regions.item;
    int n = 0;
    for (int k = 0; k < FIXED; k++) snprintf(r->column[n++], NAME, "%s", fixed[k]);
    for (int g = 0; g < r->s->groups; g++) snprintf(r->column[n++], NAME, "left_%s", r->s->group[g].name);
    for (int k = 0; k < def->walls.n; k++) {
        if (is_exit(r, k)) snprintf(r->column[n++], NAME, "%.60s_kg", w[k].part.name);
        for (int c = 0; c < 3 && !is_exit(r, k); c++) snprintf(r->column[n++], NAME, "%.60s_F%c_N", w[k].part.name, "xyz"[c]);
    }
    for (int k = 0; k < def->measure.regions.n; k++)
        for (int c = 0; c < OF_REGION; c++) snprintf(r->column[n++], NAME, "%.60s_%s", m[k].part.name, of_region[c]);
    if (r->s->wet) snprintf(r->column[n++], NAME, "bridges"), snprintf(r->column[n++], NAME, "liquid_kg");
    if (scene_has_polyhedra(r->s)) snprintf(r->column[n++], NAME, "core_overlaps");
    r->columns = n;
}

/* What a column is of: two of one name are told at the later one's place. */
static const tree *place_of(const report *r, int column) {
    const scene_def *def = r->s->def;
    const wall_def *w = def->walls.item;
    const measured_region *m = def->measure.regions.item;
    const feed_def *of_group = NULL;
    column -= FIXED;
    for (int k = 0; k < r->s->sources && !of_group; k++)
        if (r->s->source[k].group == column) of_group = r->s->source[k].def;
    if (of_group) return of_group->part.where;
    column -= r->s->groups;
    for (int k = 0; k < def->walls.n; k++) {
        column -= is_exit(r, k) ? 1 : 3;
        if (column < 0) return w[k].part.where;
    }
    return column < OF_REGION * def->measure.regions.n ? m[column / OF_REGION].part.where : def->part.where;
}

static int check_columns(report *r) {
    for (int c = 0; c < r->columns; c++)
        for (int d = 0; d < c; d++)
            if (strcmp(r->column[c], r->column[d]) == 0)
                return tree_fail(r->s->file, place_of(r, c),
                                 "two columns would have the name %.90s: another name, or label, tells them apart", r->column[c]);
    return 0;
}

static int column_of(const report *r, const char *name) {
    for (int c = 0; c < r->columns; c++)
        if (strcmp(r->column[c], name) == 0) return c;
    return -1;
}

static int refuse_column(report *r, const tree *at, const char *word) {
    const char **names = tree_memory(r->s->file, (size_t)r->columns * sizeof *names);
    for (int c = 0; names && c < r->columns; c++) names[c] = r->column[c];
    return names ? fields_refuse_word(r->s->file, at, "column", word, names, r->columns) : -1;
}

static int check_stops(report *r) {
    const stop_def *stop = r->s->def->stop.item;
    for (int k = 0; k < r->s->def->stop.n; k++)
        if (column_of(r, stop[k].column) < 0) return refuse_column(r, fields_where(&stop[k].part, "column"), stop[k].column);
    return 0;
}

/* The next word of `curves`; NULL at the end. "left_*, out_kg; kinetic_J" has three, in two panels. */
static const char *next_word(const char *at, char *word, size_t size) {
    at += strspn(at, " ,;\n");
    const size_t length = strcspn(at, " ,;\n");
    if (length == 0) return NULL;
    snprintf(word, size, "%.*s", (int)length, at);
    return at + length;
}

/* Whether a word of `curves` means a column: its name, or the beginning of it before '*'. */
static int means(const char *word, const char *column) {
    const size_t length = strlen(word);
    if (length > 0 && word[length - 1] == '*') return strncmp(word, column, length - 1) == 0;
    return strcmp(word, column) == 0;
}

static int check_curves(report *r) {
    const output_def *o = &r->s->def->output;
    char word[NAME];
    int panels = 1;
    for (const char *at = o->curves; at && (at = next_word(at, word, sizeof word)) != NULL;) {
        int found = 0;
        for (int c = 1; c < r->columns; c++) found |= means(word, r->column[c]);
        if (!found) return refuse_column(r, fields_where(&o->part, "curves"), word);
    }
    for (const char *c = o->curves; c && *c; c++) panels += *c == ';';
    return panels <= 6 ? 0 : tree_fail(r->s->file, fields_where(&o->part, "curves"), "curves: %d panels; allowed are at most 6", panels);
}

report *report_open(scene *s, const char *folder) {
    const scene_def *def = s->def;
    const measured_region *m = def->measure.regions.item;
    const size_t most = FIXED + (size_t)s->groups + 3 * DEM_WALLS_MAX + OF_REGION * (size_t)def->measure.regions.n + 3;
    report *r = tree_memory(s->file, sizeof *r);
    if (!r) return NULL;
    r->s = s, r->folder = folder;
    for (int k = 0; k < s->sources; k++) r->bodies |= s->source[k].shape != NULL;
    r->column = tree_memory(s->file, most * sizeof *r->column);
    r->region = tree_memory(s->file, ((size_t)def->measure.regions.n + 1) * sizeof *r->region);
    if (!r->column || !r->region) return NULL;
    name_columns(r);
    if (check_columns(r)) return NULL;
    for (int k = 0; k < def->measure.regions.n; k++)
        if (scene_region(s->file, &m[k].region, &r->region[k])) return NULL;
    if (check_stops(r) || check_curves(r)) return NULL;
    r->look.speed = def->output.colour == 1 ? def->output.top_speed : 0.0;
    memcpy(r->look.direction, def->output.view, sizeof r->look.direction);
    for (int g = 0; g < s->groups && g < 8; g++) r->look.names[r->look.n_names++] = s->group[g].name;
    return r;
}

/* ---- rows ---- */

/* Room for one more of n things of a size; 0, or -1. */
static int make_room(void *array, int n, int *room, size_t size) {
    void *old, *more;
    memcpy(&old, array, sizeof old);
    if (n < *room) return 0;
    const int wanted = 2 * *room + 64;
    more = realloc(old, (size_t)wanted * size);
    if (!more) return common_fail("out of memory");
    memcpy(array, &more, sizeof more);
    *room = wanted;
    return 0;
}

static int add_regions(const report *r, double *row) {
    dem_measure m;
    for (int k = 0; k < r->s->def->measure.regions.n; k++, row += OF_REGION) {
        if (dem_measure_region(&r->s->world, &r->region[k], &m) != DEM_OK) memset(&m, 0, sizeof m);
        double pressure = 0.0;
        for (int c = 0; c < 3; c++) pressure += (m.contact_stress[c][c] + m.kinetic_stress[c][c]) / 3.0;
        const double line[OF_REGION] = {(double)m.count, m.mass,       m.solid_fraction, m.coordination,
                                        m.velocity.x,    m.velocity.y, m.velocity.z,     pressure};
        memcpy(row, line, sizeof line);
    }
    return OF_REGION * r->s->def->measure.regions.n;
}

/* Both sums have their own rounding: 1e-12 is nothing. */
static double left_of(const size_group *g) {
    const double left = 1.0 - g->passed / g->fed; /* NaN before anything is fed */
    return left < 1e-12 ? 0.0 : left;
}

static double diameter_of(const dem_world *world, ptrdiff_t i) {
    return dem_shape_of(world, i) >= 0 ? dem_get_body(world, i).diameter : 2.0 * dem_radius(world, i);
}

/* Of all contacts that are there now, over the smaller particle's diameter; of a clump that of its spheres, of a polyhedron that of the
   sphere of its volume. */
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

static void measure(report *r) {
    const scene *s = r->s;
    const dem_world *world = &s->world;
    if (make_room(&r->row, r->rows, &r->room, (size_t)r->columns * sizeof *r->row)) return;
    double *row = r->row + (size_t)r->rows++ * (size_t)r->columns, *at = row;
    double count = 0.0, mass = 0.0;
    const double now = scene_time(s), passed = now - r->looked;
    for (ptrdiff_t i = 0; i < world->count; i++)
        if (world->alive[i] && (!r->bodies || dem_get_body(world, i).first == i)) count += 1.0, mass += dem_mass(world, i);
    const dem_energy_ledger energy = dem_energy(world);
    *at++ = now, *at++ = count, *at++ = mass, *at++ = energy.kinetic + energy.rotational, *at++ = largest_overlap(world);
    for (int g = 0; g < s->groups; g++) *at++ = left_of(&s->group[g]);
    for (int k = 0; k < s->def->walls.n; k++) {
        const int wall = s->wall_of[k];
        if (is_exit(r, k)) {
            *at++ = s->exit_mass[wall];
            continue;
        }
        for (int c = 0; c < 3; c++)
            *at++ = passed > 0.0 ? (dem_axis(world->wall[wall].impulse, c) - dem_axis(r->impulse[wall], c)) / passed : (double)NAN;
        r->impulse[wall] = world->wall[wall].impulse;
    }
    at += add_regions(r, at);
    if (s->wet) {
        int bridges;
        const double volume = scene_wet_total(s, &bridges);
        *at++ = bridges, *at++ = volume * s->def->liquid.density;
    }
    if (scene_has_polyhedra(s)) *at++ = (double)dem_core_overlaps(world);
    r->looked = now;
}

static const stop_def *stopped(const report *r) {
    const stop_def *stop = r->s->def->stop.item;
    const double *row = r->row + (size_t)(r->rows - 1) * (size_t)r->columns;
    for (int k = 0; k < r->s->def->stop.n; k++) {
        const double value = row[column_of(r, stop[k].column)];
        if (row[0] >= stop[k].after - 1e-9 * r->s->tick && (value < stop[k].below || value > stop[k].above)) return &stop[k];
    }
    return NULL;
}

/* ---- frames ---- */

/* After --continue: the frames that were there before stand in the index again. */
static int open_series(report *r) {
    if (!r->series.particles) {
        r->series = dem_io_open(r->folder, "scene");
        if (r->frames && scene_has_polyhedra(r->s)) r->series.polyhedra = riddle_io_series_open(r->folder, "scene_polyhedra");
        for (int k = 0; k < r->frames && r->series.particles; k++) {
            riddle_io_series_name(r->series.particles, r->frame[k]);
            riddle_io_series_name(r->series.walls, r->frame[k]);
            if (r->series.polyhedra) riddle_io_series_name(r->series.polyhedra, r->frame[k]);
        }
    }
    return r->series.particles ? 0 : common_fail("%s: the series could not be begun", r->folder);
}

static void draw_picture(report *r) { r->pictured = draw_world(&r->s->world, &r->look, r->folder, "scene.png") == 0, r->drawn = 1; }

/* All particles, a row each, spheres of bodies too; other programs read it as a start. */
static void write_table(const report *r, double number) {
    const dem_world *w = &r->s->world;
    char name[40];
    snprintf(name, sizeof name, "particles_%04.0f.csv", number);
    riddle_io_file *file = riddle_io_open(r->folder, name);
    riddle_io_print(file, "# time %.9g s\nid,x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s,omega_x_rad_s,omega_y_rad_s,omega_z_rad_s,diameter_m,mass_kg,group,contacts\n",
                    scene_time(r->s));
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        const dem_vec x = dem_position(w, i), v = dem_velocity(w, i), s = dem_spin(w, i);
        const double row[14] = {(double)w->id[i], x.x, x.y, x.z, v.x, v.y, v.z, s.x, s.y, s.z, 2.0 * dem_radius(w, i), dem_mass(w, i),
                                w->group[i], w->touching[i]};
        riddle_io_row(file, row, 14);
    }
    riddle_io_close(file);
}

/* A multiple of the time between tables lies within the last tick, or at its end. */
static void add_table(report *r) {
    const double every = r->s->def->output.tables, now = scene_time(r->s), soon = now + 1e-9 * r->s->tick;
    const double number = floor(soon / every), before = now > 0.0 ? floor((soon - (r->s->beyond > 0.0 ? r->s->beyond : r->s->tick)) / every) : -1.0;
    if (every > 0.0 && number > before) write_table(r, number);
}

static void add_frames(report *r) {
    const output_def *o = &r->s->def->output;
    const double now = scene_time(r->s), soon = now + 1e-9 * r->s->tick;
    add_table(r);
    if (o->frames > 0.0 && soon >= r->next_frame * o->frames) {
        if (open_series(r) || make_room(&r->frame, r->frames, &r->frame_room, sizeof *r->frame)) return;
        r->frame[r->frames++] = r->s->world.time, r->next_frame += 1.0;
        dem_io_add(&r->series, &r->s->world);
    }
    if (!r->drawn && soon >= o->picture) draw_picture(r);
    if (!o->movie) return;
    if (!r->film.film && !r->filmed) {
        char name[40];
        snprintf(name, sizeof name, now > 0.0 ? "scene_from_%gs.mp4" : "scene.mp4", now);
        r->film = world_movie_open(r->folder, name, &r->look);
        r->filmed = (int)(now / o->movie_rate * FRAMES_A_SECOND);
    }
    if (soon >= r->filmed * o->movie_rate / FRAMES_A_SECOND) world_movie_add(&r->film, &r->s->world), r->filmed++;
}

const stop_def *report_look(report *r) {
    const double ticks_a_row = floor(r->s->def->measure.every / r->s->tick + 0.5);
    const bool row = fmod(r->s->ticks, ticks_a_row) == 0.0 && (r->rows == 0 || r->looked < scene_time(r->s));
    if (row) measure(r);
    add_frames(r);
    return row && r->rows ? stopped(r) : NULL;
}

const stop_def *report_end(report *r) {
    if (r->rows && !(r->looked < scene_time(r->s))) return NULL;
    measure(r);
    add_frames(r);
    return r->rows ? stopped(r) : NULL;
}

/* ---- the end ---- */

/* "feed_3.5-7mm" as one says it: "feed 3.5 to 7 mm". */
static const char *said(const char *name, char *text, size_t size) {
    size_t n = 0;
    for (const char *c = name; *c && n + 5 < size; c++) {
        const int after_digit = c > name && c[-1] >= '0' && c[-1] <= '9';
        if (*c == '_') text[n++] = ' ';
        else if (*c == '-' && after_digit && c[1] >= '0' && c[1] <= '9') n += (size_t)snprintf(text + n, size - n, " to ");
        else if (strncmp(c, "mm", 2) == 0 && after_digit && (!c[2] || c[2] == '_')) n += (size_t)snprintf(text + n, size - n, " m");
        else text[n++] = *c;
    }
    text[n] = '\0';
    return text;
}

/* The unit that a column's name ends with. */
static const char *unit_of(const char *column) {
    static const char *const units[][2] = {{"_kg", "kg"}, {"_m_s", "m/s"}, {"_N", "N"}, {"_J", "J"}, {"_Pa", "Pa"}, {"_N_m", "N m"}, {"_W", "W"}, {"_s", "s"}};
    for (size_t k = 0; k < sizeof units / sizeof *units; k++) {
        const size_t length = strlen(column), ending = strlen(units[k][0]);
        if (length > ending && strcmp(column + length - ending, units[k][0]) == 0) return units[k][1];
    }
    return "-";
}

static void draw_column(const report *r, riddle_plot *p, int c, const char *label, const double *x, double *y) {
    char text[NAME + 40];
    for (int k = 0; k < r->rows; k++) y[k] = r->row[(size_t)k * (size_t)r->columns + (size_t)c];
    riddle_plot_line(p, said(label, text, sizeof text), x, y, r->rows);
}

/* What `curves` names: a panel for each part between ';'. */
static void draw_chosen(const report *r, riddle_plot *p, const double *x, double *y) {
    char word[NAME], label[NAME + 40];
    int panel = 0;
    for (const char *at = r->s->def->output.curves; at; panel++) {
        const char *end = strchr(at, ';'), *word_end;
        const char *unit = NULL, *only = NULL;
        int n = 0;
        for (int c = 1; c < r->columns; c++)
            for (const char *w = at; (word_end = next_word(w, word, sizeof word)) != NULL && (!end || word_end <= end); w = word_end)
                if (means(word, r->column[c])) {
                    unit = !unit || strcmp(unit, unit_of(r->column[c])) == 0 ? unit_of(r->column[c]) : "units as named";
                    only = r->column[c];
                    n++;
                    break;
                }
        snprintf(label, sizeof label, "%s%s[%s]", n == 1 ? only : "", n == 1 ? " " : "", unit ? unit : "-");
        riddle_plot_panel(p, 0, panel, "time [s]", label);
        for (int c = 1; c < r->columns; c++)
            for (const char *w = at; (word_end = next_word(w, word, sizeof word)) != NULL && (!end || word_end <= end); w = word_end)
                if (means(word, r->column[c])) {
                    draw_column(r, p, c, r->column[c], x, y);
                    break;
                }
        at = end ? end + 1 : NULL;
    }
}

/* Without `curves`: what is left of each class, and masses. */
static void draw_usual(const report *r, riddle_plot *p, const double *x, double *y) {
    const scene *s = r->s;
    const int shown = s->groups < CURVES ? s->groups : CURVES;
    riddle_plot_panel(p, 0, 0, "time [s]", "share left of what was fed [-]");
    for (int c = 0; c < shown; c++) {
        const int g = shown > 1 ? c * (s->groups - 1) / (shown - 1) : 0; /* of many classes some, from end to end */
        draw_column(r, p, FIXED + g, s->group[g].name, x, y);
    }
    riddle_plot_range_y(p, 0.0, 1.02);
    riddle_plot_panel(p, 0, 1, "time [s]", "mass [kg]");
    for (int c = 2; c < r->columns; c++) {
        const size_t length = strlen(r->column[c]);
        if (length < 3 || strcmp(r->column[c] + length - 3, "_kg") != 0 || (c != 2 && c < FIXED + s->groups)) continue;
        draw_column(r, p, c, c == 2 ? "particles" : r->column[c], x, y);
    }
}

/* 0, or not, after a printed line. */
static int draw_curves(const report *r) {
    const char *chosen = r->s->def->output.curves;
    int panels = chosen ? 1 : 2;
    for (const char *c = chosen; c && *c; c++) panels += *c == ';';
    riddle_plot *p = riddle_plot_new(r->s->def->title, 1, panels);
    double *x = malloc(((size_t)r->rows + 1) * 2 * sizeof *x), *y = x + r->rows;
    for (int k = 0; x && k < r->rows; k++) x[k] = r->row[(size_t)k * (size_t)r->columns];
    if (x && chosen) draw_chosen(r, p, x, y);
    else if (x) draw_usual(r, p, x, y);
    const int failed = riddle_plot_write(p, r->folder, "curves.svg") != RIDDLE_IO_OK;
    free(x);
    return failed;
}

static void add_name(report *r, const char *name) {
    const size_t used = strlen(r->written);
    snprintf(r->written + used, sizeof r->written - used, "%s%s", used ? ", " : "", name);
}

double report_overlap(const report *r) {
    double largest = 0.0;
    for (int k = 0; k < r->rows; k++) largest = fmax(largest, r->row[(size_t)k * (size_t)r->columns + OVERLAP]);
    return largest;
}

/* Mean of a column over the second half of the rows; flow: of what an exit took between two rows [t/h]. */
static steady_mean mean_of(const report *r, int column, int flow, double *room) {
    const size_t width = (size_t)r->columns;
    const int first = r->rows / 2 > 0 ? r->rows / 2 : 1;
    int n = 0;
    for (int k = first; k < r->rows; k++) {
        const double *row = r->row + (size_t)k * width, *before = row - width;
        const double passed = row[0] - before[0];
        if (!(passed > 0.5 * r->s->def->measure.every)) continue; /* the last row may be an early one */
        room[n++] = flow ? 3.6 * (row[column] - before[column]) / passed : row[column];
    }
    return steady_mean_of(room, n);
}

/* Visits the columns that have a mean: all but the time, and exits also as a flow. */
static void each_mean(const report *r, void (*visit)(void *user, const char *name, const steady_mean *mean), void *user) {
    double *room = malloc(((size_t)r->rows + 1) * sizeof *room);
    const int last_exit = r->columns - (scene_has_polyhedra(r->s) ? 1 : 0) - (r->s->wet ? 2 : 0) - OF_REGION * r->s->def->measure.regions.n;
    for (int c = 1; room && c < r->columns; c++) {
        char name[NAME + 8];
        const size_t length = strlen(r->column[c]);
        steady_mean mean = mean_of(r, c, 0, room);
        visit(user, r->column[c], &mean);
        if (c < FIXED + r->s->groups || c >= last_exit || length < 3 || strcmp(r->column[c] + length - 3, "_kg") != 0) continue;
        snprintf(name, sizeof name, "%.*s_t_per_h", (int)length - 3, r->column[c]);
        mean = mean_of(r, c, 1, room);
        visit(user, name, &mean);
    }
    free(room);
}

static const double STUDENT = 2.365; /* 95 %, 7 degrees of freedom */

static void write_mean(void *user, const char *name, const steady_mean *m) {
    riddle_io_print(user, "%s,%.9g,%.9g,%.9g,%.9g,%d\n", name, m->mean, m->error, STUDENT * m->error, m->drift, m->is_steady);
}
static void json_mean(void *user, const char *name, const steady_mean *m) {
    json_object_begin(user, name);
    json_number(user, "mean", m->mean);
    json_number(user, "interval95", STUDENT * m->error);
    json_bool(user, "steady", m->is_steady);
    json_object_end(user);
}

const char *report_write(report *r) {
    riddle_io_file *table_file = riddle_io_open(r->folder, "measured.csv");
    for (int c = 0; c < r->columns; c++) riddle_io_print(table_file, "%s%s", c ? "," : "", r->column[c]);
    riddle_io_print(table_file, "\n");
    for (int k = 0; k < r->rows; k++) riddle_io_row(table_file, r->row + (size_t)k * (size_t)r->columns, r->columns);
    if (riddle_io_close(table_file) == RIDDLE_IO_OK) add_name(r, "measured.csv");
    if (r->rows >= 4 * STEADY_BLOCKS) {
        riddle_io_file *means = riddle_io_open(r->folder, "means.csv");
        riddle_io_print(means, "column,mean,standard_error,interval95,drift,steady\n");
        each_mean(r, write_mean, means);
        if (riddle_io_close(means) == RIDDLE_IO_OK) add_name(r, "means.csv");
    }
    if (r->rows > 1 && draw_curves(r) == 0) add_name(r, "curves.svg");
    if (!r->drawn) draw_picture(r);
    if (r->pictured) add_name(r, "scene.png");
    if (r->series.particles) dem_io_close(&r->series);
    if (r->film.film) world_movie_close(&r->film);
    return r->written;
}

void report_json(const report *r, json *j) {
    const double *row = r->rows ? r->row + (size_t)(r->rows - 1) * (size_t)r->columns : NULL;
    json_object_begin(j, "last_row");
    for (int c = 0; row && c < r->columns; c++) json_number(j, r->column[c], row[c]);
    json_object_end(j);
    json_object_begin(j, "means_of_second_half");
    if (j && r->rows >= 4 * STEADY_BLOCKS) each_mean(r, json_mean, j);
    json_object_end(j);
    json_integer(j, "rows", r->rows);
    json_integer(j, "frames", r->frames);
}

int report_exchange(report *r, scene_state *io) {
    const output_def *o = &r->s->def->output;
    double counts[] = {r->rows, r->frames, r->looked, r->drawn, r->next_frame, o->frames};
    state_same(io, r->columns);
    state_numbers(io, counts, 6);
    if (io->failed || !(counts[0] >= 0.0 && counts[0] < 1e9 && counts[1] >= 0.0 && counts[1] < 1e9)) return io->failed = 1, -1;
    if (io->reading) {
        r->rows = r->frames = 0;
        r->looked = counts[2], r->drawn = r->pictured = counts[3] != 0.0 && scene_time(r->s) >= o->picture;
        r->next_frame =
            counts[5] == o->frames ? counts[4] : floor(scene_time(r->s) / o->frames + 1e-9) + 1.0; /* at other times than before */
    }
    while (r->rows < (int)counts[0] && !io->failed) { /* as many as the save really holds */
        if (make_room(&r->row, r->rows, &r->room, (size_t)r->columns * sizeof *r->row)) return io->failed = 1, -1;
        state_numbers(io, r->row + (size_t)r->rows++ * (size_t)r->columns, (size_t)r->columns);
    }
    for (int k = 0; !io->reading && k < r->rows; k++) state_numbers(io, r->row + (size_t)k * (size_t)r->columns, (size_t)r->columns);
    while (r->frames < (int)counts[1] && !io->failed) {
        if (make_room(&r->frame, r->frames, &r->frame_room, sizeof *r->frame)) return io->failed = 1, -1;
        state_numbers(io, &r->frame[r->frames++], 1);
    }
    if (!io->reading) state_numbers(io, r->frame, (size_t)r->frames);
    for (int k = 0; k < DEM_WALLS_MAX; k++) {
        double v[3] = {r->impulse[k].x, r->impulse[k].y, r->impulse[k].z};
        state_numbers(io, v, 3);
        r->impulse[k] = dem_vec3(v[0], v[1], v[2]);
    }
    return io->failed ? -1 : 0;
}

void report_free(report *r) {
    if (!r) return;
    free(r->row);
    free(r->frame);
    r->row = r->frame = NULL;
}
