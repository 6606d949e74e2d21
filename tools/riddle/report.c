/* report.c: see report.h */
#include "report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "world_picture.h"
#include "earlier.h"
#include "load_map.h"
#include "scene_results.h"
#include "rows.h"
#include "scene_books.h"
#include "scene_shapes.h"
#include "steady.h"

enum { NAME = ROWS_NAME, OVERLAP = 4, CURVES = 8, FRAMES_A_SECOND = 25 };

struct report {
    scene *s;
    const char *folder;
    row_table rows;
    load_maps *loads;
    separation *separation; /* at the end; NULL: none */
    double loaded;          /* ticks that are in the maps */
    double *frame;          /* times of the frames [s] */
    int frames, frame_room;
    double next_frame; /* is due at this number of intervals */
    dem_io_series series;
    picture_def look;
    world_movie film;
    int filmed, drawn, pictured; /* pictured: and it is there */
    char written[800];
};

/* ---- words that name columns ---- */

/* "feed_3.5-7mm" as one says it: "feed 3.5 to 7 mm". */
static const char *said(const char *name, char *text, size_t size) {
    size_t n = 0;
    for (const char *c = name; *c && n + 5 < size; c++) {
        const int after_digit = c > name && c[-1] >= '0' && c[-1] <= '9';
        if (*c == '_') text[n++] = ' ';
        else if (*c == '-' && after_digit && c[1] >= '0' && c[1] <= '9')
            n += (size_t)snprintf(text + n, size - n, " to ");
        else if (strncmp(c, "mm", 2) == 0 && after_digit && (!c[2] || c[2] == '_'))
            n += (size_t)snprintf(text + n, size - n, " m");
        else text[n++] = *c;
    }
    text[n] = '\0';
    return text;
}

static int refuse_column(report *r, const tree *at, const char *word) {
    const row_table *rows = &r->rows;
    const char **names = tree_memory(r->s->file, (size_t)rows->columns * sizeof *names);
    for (int c = 0; names && c < rows->columns; c++) names[c] = rows->column[c].name;
    return names ? fields_refuse_word(r->s->file, at, "column", word, names, rows->columns) : -1;
}

static int check_stops(report *r) {
    const stop_def *stop = r->s->def->stop.item;
    for (int k = 0; k < r->s->def->stop.n; k++)
        if (rows_column(&r->rows, stop[k].column) < 0)
            return refuse_column(r, fields_where(&stop[k].part, "column"), stop[k].column);
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
        for (int c = 1; c < r->rows.columns; c++) found |= means(word, r->rows.column[c].name);
        if (!found) return refuse_column(r, fields_where(&o->part, "curves"), word);
    }
    for (const char *c = o->curves; c && *c; c++) panels += *c == ';';
    return panels <= 6 ? 0
                       : tree_fail(r->s->file, fields_where(&o->part, "curves"),
                                   "curves: %d panels; allowed are at most 6", panels);
}

report *report_open(scene *s, const char *folder, const int size[2]) {
    const scene_def *def = s->def;
    report *r = tree_memory(s->file, sizeof *r);
    if (!r) return NULL;
    r->s = s, r->folder = folder;
    r->loads = load_maps_open(s);
    if (!r->loads || rows_open(&r->rows, s) || check_stops(r) || check_curves(r)) return NULL;
    r->look.speed = def->output.colour == 1 ? def->output.top_speed : 0.0;
    memcpy(r->look.size, size, sizeof r->look.size);
    memcpy(r->look.direction, def->output.view, sizeof r->look.direction);
    for (int g = 0; g < s->groups && g < 8; g++) {
        char *text = tree_memory(s->file, NAME);
        if (!text) return NULL;
        r->look.names[r->look.n_names++] = said(s->group[g].name, text, NAME);
    }
    return r;
}

void report_begin(const report *r) { earlier_remove_series(r->folder); }

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

static const stop_def *stopped(const report *r) {
    const stop_def *stop = r->s->def->stop.item;
    const int last = r->rows.n - 1;
    for (int k = 0; k < r->s->def->stop.n; k++) {
        const double value = rows_at(&r->rows, last, rows_column(&r->rows, stop[k].column));
        if (rows_at(&r->rows, last, 0) >= stop[k].after - 1e-9 * r->s->tick &&
            (value < stop[k].below || value > stop[k].above))
            return &stop[k];
    }
    return NULL;
}

/* ---- frames ---- */

/* After --continue: the frames that were there before stand in the index again. */
static int open_series(report *r) {
    if (!r->series.particles) {
        r->series = dem_io_open(r->folder, "scene");
        if (r->frames && scene_has_polyhedra(r->s))
            r->series.polyhedra = riddle_io_series_open(r->folder, "scene_polyhedra");
        for (int k = 0; k < r->frames && r->series.particles; k++) {
            riddle_io_series_name(r->series.particles, r->frame[k]);
            riddle_io_series_name(r->series.walls, r->frame[k]);
            if (r->series.polyhedra) riddle_io_series_name(r->series.polyhedra, r->frame[k]);
        }
    }
    return r->series.particles ? 0 : common_fail("%s: the series could not be begun", r->folder);
}

static void draw_picture(report *r) {
    r->pictured = draw_world(&r->s->world, &r->look, r->folder, "scene.png") == 0, r->drawn = 1;
}

/* All particles, a row each, spheres of bodies too; other programs read it as a start. */
static void write_table(const report *r, double number) {
    const dem_world *w = &r->s->world;
    char name[40];
    snprintf(name, sizeof name, "particles_%04.0f.csv", number);
    riddle_io_file *file = riddle_io_open(r->folder, name);
    riddle_io_print(file,
                    "# time %.9g "
                    "s\nid,x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s,omega_x_rad_s,omega_y_rad_s,omega_z_rad_s,diameter_m,mass_"
                    "kg,group,contacts\n",
                    scene_time(r->s));
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        const dem_vec x = dem_position(w, i), v = dem_velocity(w, i), s = dem_spin(w, i);
        const double row[14] = {
            (double)w->id[i], x.x,         x.y,           x.z, v.x, v.y, v.z, s.x, s.y, s.z, 2.0 * dem_radius(w, i),
            dem_mass(w, i),   w->group[i], w->touching[i]};
        riddle_io_row(file, row, 14);
    }
    riddle_io_close(file);
}

/* A multiple of the time between tables lies within the last tick, or at its end. */
static void add_table(report *r) {
    const double every = r->s->def->output.tables, now = scene_time(r->s), soon = now + 1e-9 * r->s->tick;
    const double number = floor(soon / every),
                 before = now > 0.0 ? floor((soon - (r->s->beyond > 0.0 ? r->s->beyond : r->s->tick)) / every) : -1.0;
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
    if (r->s->ticks > r->loaded) load_maps_add(r->loads, r->s->tick), r->loaded = r->s->ticks;
    const double ticks_a_row = floor(r->s->def->measure.every / r->s->tick + 0.5);
    const bool row = fmod(r->s->ticks, ticks_a_row) == 0.0 && (r->rows.n == 0 || r->rows.looked < scene_time(r->s));
    if (row) rows_measure(&r->rows);
    add_frames(r);
    return row && r->rows.n ? stopped(r) : NULL;
}

const stop_def *report_end(report *r) {
    if (r->rows.n && !(r->rows.looked < scene_time(r->s))) return NULL;
    rows_measure(&r->rows);
    add_frames(r);
    return r->rows.n ? stopped(r) : NULL;
}

/* ---- the end ---- */

/* The unit that a column's name ends with, and the ending: units[k][1] and [0]; "-" and "" where there is none. */
static const char *const *unit_and_ending(const char *column) {
    static const char *const none[2] = {"", "-"}, *const units[][2] = {
                                                      {"_kg", "kg"}, {"_kg_s", "kg/s"}, {"_m_s", "m/s"}, {"_N", "N"},
                                                      {"_J", "J"},   {"_Pa", "Pa"},     {"_N_m", "N m"}, {"_W", "W"},
                                                      {"_s", "s"},   {"_m", "m"},       {"_deg", "°"}};
    for (size_t k = 0; k < sizeof units / sizeof *units; k++) {
        const size_t length = strlen(column), ending = strlen(units[k][0]);
        if (length > ending && strcmp(column + length - ending, units[k][0]) == 0) return units[k];
    }
    return none;
}
static const char *unit_of(const char *column) { return unit_and_ending(column)[1]; }
static const char *ending_of(const char *column) { return unit_and_ending(column)[0]; }

static const char MIXED[] = "units as named"; /* what an axis says of curves with different units */

/* A column's name as one says it, without the unit that it ends with where the axis names a unit; where the axis says
   MIXED, with it. */
static const char *title_of(const char *column, const char *axis, char *text, size_t size) {
    char name[NAME];
    const size_t length = strlen(column) - (axis ? strlen(ending_of(column)) : 0);
    snprintf(name, sizeof name, "%.*s", (int)length, column);
    said(name, text, size);
    if (axis == MIXED) snprintf(text + strlen(text), size - strlen(text), " [%s]", unit_of(column));
    return text;
}

/* axis: the unit of the panel. */
static void draw_column(const report *r, riddle_plot *p, int c, const char *label, const char *axis, const double *x,
                        double *y) {
    char text[NAME + 40];
    for (int k = 0; k < r->rows.n; k++) y[k] = rows_at(&r->rows, k, c);
    riddle_plot_line(p, title_of(label, axis, text, sizeof text), x, y, r->rows.n);
}

static bool is_zero(const report *r, int c) {
    for (int k = 0; k < r->rows.n; k++)
        if (fabs(rows_at(&r->rows, k, c)) > 0.0) return false;
    return true;
}

/* Whether the panel whose words begin here draws a column. */
static bool is_chosen(const char *at, const char *column) {
    char word[NAME];
    const char *end = at + strcspn(at, ";");
    while ((at = next_word(at, word, sizeof word)) != NULL && at <= end)
        if (means(word, column)) return true;
    return false;
}

/* What `curves` names: a panel for each part between ';'. */
static void draw_chosen(const report *r, riddle_plot *p, const double *x, double *y) {
    int panel = 0;
    for (const char *at = r->s->def->output.curves; at; panel++) {
        char label[NAME + 40], title[NAME] = "";
        const char *unit = NULL, *end = strchr(at, ';');
        int n = 0;
        for (int c = 1; c < r->rows.columns; c++) {
            const char *name = r->rows.column[c].name;
            if (!is_chosen(at, name)) continue;
            unit = !unit || strcmp(unit, unit_of(name)) == 0 ? unit_of(name) : MIXED;
            if (n++ == 0) title_of(name, unit, title, sizeof title);
        }
        if (unit == MIXED) snprintf(label, sizeof label, "%s", MIXED);
        else snprintf(label, sizeof label, "%s%s[%s]", n == 1 ? title : "", n == 1 ? " " : "", unit ? unit : "-");
        riddle_plot_panel(p, 0, panel, "time [s]", label);
        for (int c = 1; c < r->rows.columns; c++)
            if (is_chosen(at, r->rows.column[c].name)) draw_column(r, p, c, r->rows.column[c].name, unit, x, y);
        at = end ? end + 1 : NULL;
    }
}

/* Without `curves`: what is left of each class, and the masses that are not 0 all the time. */
static void draw_usual(const report *r, riddle_plot *p, const double *x, double *y) {
    const scene *s = r->s;
    const int shown = s->groups < CURVES ? s->groups : CURVES;
    riddle_plot_panel(p, 0, 0, "time [s]", "share left of what was fed [-]");
    for (int c = 0; c < shown; c++) {
        const int g = shown > 1 ? c * (s->groups - 1) / (shown - 1) : 0; /* of many classes some, from end to end */
        draw_column(r, p, ROWS_LEFT_FROM + g, s->group[g].name, NULL, x, y);
    }
    riddle_plot_range_y(p, 0.0, 1.02);
    riddle_plot_panel(p, 0, 1, "time [s]", "mass [kg]");
    for (int c = 2; c < r->rows.columns; c++) {
        const size_t length = strlen(r->rows.column[c].name);
        const row_column *at = &r->rows.column[c];
        if (length < 3 || strcmp(at->name + length - 3, "_kg") != 0 || (c != 2 && c < ROWS_LEFT_FROM + s->groups) ||
            at->kind == ROW_CLASS || (c != 2 && is_zero(r, c)))
            continue;
        draw_column(r, p, c, c == 2 ? "particles" : r->rows.column[c].name, "kg", x, y);
    }
}

/* 0, or not, after a printed line. */
static int draw_curves(const report *r) {
    const char *chosen = r->s->def->output.curves;
    int panels = chosen ? 1 : 2;
    for (const char *c = chosen; c && *c; c++) panels += *c == ';';
    riddle_plot *p = riddle_plot_new(r->s->def->title, 1, panels);
    double *x = malloc(((size_t)r->rows.n + 1) * 2 * sizeof *x), *y = x + r->rows.n;
    for (int k = 0; x && k < r->rows.n; k++) x[k] = rows_at(&r->rows, k, 0);
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

static void add_result(void *user, const char *name) { add_name(user, name); }

double report_overlap(const report *r) {
    double largest = 0.0;
    for (int k = 0; k < r->rows.n; k++) largest = fmax(largest, rows_at(&r->rows, k, OVERLAP));
    return largest;
}

/* Mean of a column over the second half of the rows; flow: of what an exit took between two rows [t/h]. */
static steady_mean mean_of(const report *r, int column, int flow, double *room) {
    const int first = r->rows.n / 2 > 0 ? r->rows.n / 2 : 1;
    int n = 0;
    for (int k = first; k < r->rows.n; k++) {
        const double passed = rows_at(&r->rows, k, 0) - rows_at(&r->rows, k - 1, 0),
                     value = rows_at(&r->rows, k, column);
        if (!(passed > 0.5 * r->s->def->measure.every) || isnan(value)) continue; /* the last row may be an early one */
        room[n++] = flow ? 3.6 * (value - rows_at(&r->rows, k - 1, column)) / passed : value;
    }
    return steady_mean_of(room, n);
}

/* Visits the columns that have a mean: all but the time, and exits also as a flow. */
static void each_mean(const report *r, void (*visit)(void *user, const char *name, const steady_mean *mean),
                      void *user) {
    double *room = malloc(((size_t)r->rows.n + 1) * sizeof *room);
    for (int c = 1; room && c < r->rows.columns; c++) {
        char name[NAME + 8];
        steady_mean mean = mean_of(r, c, 0, room);
        visit(user, r->rows.column[c].name, &mean);
        if (r->rows.column[c].kind != ROW_TAKEN) continue;
        snprintf(name, sizeof name, "%.*s_t_per_h", (int)strlen(r->rows.column[c].name) - 3, r->rows.column[c].name);
        mean = mean_of(r, c, 1, room);
        visit(user, name, &mean);
    }
    free(room);
}

static const double STUDENT = 2.365; /* 95 %, 7 degrees of freedom */

static void write_mean(void *user, const char *name, const steady_mean *m) {
    riddle_io_print(user, "%s,%.9g,%.9g,%.9g,%.9g,%d\n", name, m->mean, m->error, STUDENT * m->error, m->drift,
                    m->is_steady);
}
static void json_mean(void *user, const char *name, const steady_mean *m) {
    json_object_begin(user, name);
    json_number(user, "mean", m->mean);
    json_number(user, "interval95", STUDENT * m->error);
    json_bool(user, "steady", m->is_steady);
    json_object_end(user);
}

static const char means_head[] = "column,mean,standard_error,interval95,drift,steady\n",
                  passed_head[] = "time_s,exit,class,diameter_m,mass_kg,residence_s\n";

static void write_rows(report *r) {
    const row_table *rows = &r->rows;
    riddle_io_file *file = riddle_io_open(r->folder, "measured.csv");
    for (int c = 0; c < rows->columns; c++) riddle_io_print(file, "%s%s", c ? "," : "", rows->column[c].name);
    riddle_io_print(file, "\n");
    for (int k = 0; k < rows->n; k++)
        riddle_io_row(file, rows->value + (size_t)k * (size_t)rows->columns, rows->columns);
    if (riddle_io_close(file) == RIDDLE_IO_OK) add_name(r, "measured.csv");
    if (rows->n < 4 * STEADY_BLOCKS) {
        earlier_remove(r->folder, "means.csv", means_head);
        return;
    }
    file = riddle_io_open(r->folder, "means.csv");
    riddle_io_print(file, "%s", means_head);
    each_mean(r, write_mean, file);
    if (riddle_io_close(file) == RIDDLE_IO_OK) add_name(r, "means.csv");
}

static void write_passed(report *r) {
    const scene *s = r->s;
    const wall_def *w = s->def->walls.item;
    int n;
    const gone *g = scene_gone(s, &n);
    riddle_io_file *file = riddle_io_open(r->folder, "passed.csv");
    riddle_io_print(file, "%s", passed_head);
    for (int k = 0; k < n; k++) {
        int wall = 0;
        while (s->wall_of[wall] != g[k].exit) wall++;
        riddle_io_print(file, "%.9g,%s,%s,", g[k].time, w[wall].part.name, s->group[g[k].group].name);
        const double row[3] = {g[k].diameter, g[k].mass, g[k].age};
        riddle_io_row(file, row, 3);
    }
    if (riddle_io_close(file) == RIDDLE_IO_OK) add_name(r, "passed.csv");
}

const char *report_write(report *r) {
    write_rows(r);
    if (r->s->def->output.passed) write_passed(r);
    else earlier_remove(r->folder, "passed.csv", passed_head);
    if (r->rows.n < 2) earlier_remove(r->folder, "curves.svg", "<svg ");
    else if (draw_curves(r) == 0) add_name(r, "curves.svg");
    r->separation = scene_separation(r->s);
    scene_results_write(&r->rows, r->separation, r->folder, add_result, r);
    load_maps_write(r->loads, r->folder, add_result, r);
    if (!r->drawn) draw_picture(r);
    if (r->pictured) add_name(r, "scene.png");
    else earlier_remove(r->folder, "scene.png", "\x89PNG");
    if (r->series.particles) dem_io_close(&r->series);
    if (r->film.film) world_movie_close(&r->film);
    return r->written;
}

void report_write_so_far(report *r) {
    write_rows(r);
    if (r->rows.n > 1) draw_curves(r);
    r->written[0] = '\0';
}

void report_json(const report *r, json *j) {
    const row_table *rows = &r->rows;
    json_object_begin(j, "last_row");
    for (int c = 0; rows->n && c < rows->columns; c++)
        json_number(j, rows->column[c].name, rows_at(rows, rows->n - 1, c));
    json_object_end(j);
    json_object_begin(j, "means_of_second_half");
    if (j && rows->n >= 4 * STEADY_BLOCKS) each_mean(r, json_mean, j);
    json_object_end(j);
    scene_results_json(rows, r->separation, j);
    json_integer(j, "rows", rows->n);
    json_integer(j, "frames", r->frames);
}

void report_say(const report *r) { scene_results_say(&r->rows, r->separation); }

int report_exchange(report *r, scene_state *io) {
    const output_def *o = &r->s->def->output;
    double counts[] = {r->frames, r->drawn, r->next_frame, o->frames};
    state_numbers(io, &r->loaded, 1);
    if (rows_exchange(&r->rows, io) || load_maps_exchange(r->loads, io)) return -1;
    state_numbers(io, counts, 4);
    if (io->failed || !(counts[0] >= 0.0 && counts[0] < 1e9)) return io->failed = 1, -1;
    if (io->reading) {
        r->frames = 0;
        r->drawn = r->pictured = counts[1] != 0.0 && scene_time(r->s) >= o->picture;
        r->next_frame = counts[3] == o->frames
                            ? counts[2]
                            : floor(scene_time(r->s) / o->frames + 1e-9) + 1.0; /* at other times than before */
    }
    while (r->frames < (int)counts[0] && !io->failed) {
        if (make_room(&r->frame, r->frames, &r->frame_room, sizeof *r->frame)) return io->failed = 1, -1;
        state_numbers(io, &r->frame[r->frames++], 1);
    }
    if (!io->reading) state_numbers(io, r->frame, (size_t)r->frames);
    return io->failed ? -1 : 0;
}

void report_free(report *r) {
    if (!r) return;
    rows_free(&r->rows);
    scene_separation_free(r->separation);
    free(r->frame);
    r->frame = NULL;
}
