/* scene_results.c: see scene_results.h */
#include "scene_results.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "earlier.h"
#include "heap_slope.h"
#include "scene_books.h"
#include "scene_walls.h"
#include "screen_models.h"

enum { CLASSES = 1000, NAME = 120 };
static const double none = (double)NAN;

/* ---- a separation ---- */

typedef struct split_class {
    double low, high; /* [m]; as of size_group */
    tally fed, fine, coarse;
    double size, share; /* mean by mass [m]; T: what goes to coarse [-]; NaN: nothing came */
    double share_low, share_high;
} split_class;

struct separation {
    split_class *class; /* [n] by size */
    int n, full;        /* full: those of which something came */
    double cut, time;   /* [m], [s] */
    int reached;        /* the curve passes 25, 50 and 75 % */
    screen_separation value, low, high;
};

static void add(tally *sum, const tally *t, double sign) {
    sum->count += sign * t->count, sum->mass += sign * t->mass, sum->sized += sign * t->sized,
        sum->under += sign * t->under;
    sum->aged += sign * t->aged, sum->aged2 += sign * t->aged2;
}

static split_class *class_of(separation *p, double low, double high) {
    for (int k = 0; k < p->n; k++)
        if (p->class[k].low == low && p->class[k].high == high) return &p->class[k];
    split_class *c = &p->class[p->n++];
    memset(c, 0, sizeof *c);
    c->low = low, c->high = high;
    return c;
}

/* Fed, fine and coarse of each class, whatever its label. */
static void count_classes(const scene *s, separation *p) {
    const separation_def *d = &s->def->measure.separation;
    const wall_def *w = s->def->walls.item;
    for (int g = 0; g < s->groups; g++) {
        split_class *c = class_of(p, s->group[g].low, s->group[g].high);
        const tally came = scene_came_since(s, g);
        add(&c->fed, &came, 1.0);
        if (!d->coarse) add(&c->coarse, &came, 1.0);
        for (int k = 0; k < s->def->walls.n; k++) {
            if (!w[k].exit.part.where) continue;
            const tally left = scene_left_since(s, s->wall_of[k], g);
            const int fine = scene_named(d->fine, w[k].part.name);
            if (fine) add(&c->fine, &left, 1.0);
            if (d->coarse ? scene_named(d->coarse, w[k].part.name) : fine)
                add(&c->coarse, &left, d->coarse ? 1.0 : -1.0);
        }
    }
}

static int smaller_first(const void *a, const void *b) {
    const split_class *p = a, *q = b;
    const double x = isnan(p->size) ? p->low : p->size, y = isnan(q->size) ? q->low : q->size;
    return x < y ? -1 : x > y;
}

/* T of a class, and its 95 % range by the number of particles (Wilson 1927). */
static void find_share(split_class *c) {
    const double mass = c->fine.mass + c->coarse.mass, n = floor(c->fine.count + c->coarse.count + 0.5),
                 z = 1.959963984540054;
    c->size = c->share = c->share_low = c->share_high = none;
    if (n < 1.0) return;
    const double left = c->coarse.count < 0.5 ? 0.0
                        : c->fine.count < 0.5 ? mass
                                              : c->coarse.mass; /* rounding of sums */
    c->size = (c->fine.sized + c->coarse.sized) / mass;
    c->share = fmin(fmax(left / mass, 0.0), 1.0);
    const double middle = (c->share + z * z / (2.0 * n)) / (1.0 + z * z / n),
                 reach = z / (1.0 + z * z / n) * sqrt(c->share * (1.0 - c->share) / n + z * z / (4.0 * n * n));
    c->share_low = c->share > 0.0 ? fmax(middle - reach, 0.0) : 0.0;
    c->share_high = c->share < 1.0 ? fmin(middle + reach, 1.0) : 1.0;
}

/* Replaces what hangs on the cut by sums over particles, which know on which side of it they are; ranges go along. */
static void count_by_cut(separation *p) {
    tally fine = {0}, coarse = {0};
    for (int k = 0; k < p->n; k++) add(&fine, &p->class[k].fine, 1.0), add(&coarse, &p->class[k].coarse, 1.0);
    const double under = fine.under + coarse.under, over = fine.mass + coarse.mass - under,
                 passed_over = fine.mass - fine.under;
    const int cut = p->cut > 0.0;
    const double recovery = cut && under > 1e-12 * over ? fine.under / under : none,
                 loss = cut && over > 1e-12 * under ? passed_over / over : none;
    const double exact[] = {recovery, loss,
                            cut && coarse.mass > 1e-12 * fine.mass ? fmax(coarse.under, 0.0) / coarse.mass : none,
                            cut && fine.mass > 0.0 ? fmax(passed_over, 0.0) / fine.mass : none, recovery - loss};
    double *const value[] = {&p->value.recovery, &p->value.oversize_loss, &p->value.misplaced_overflow,
                             &p->value.misplaced_underflow, &p->value.efficiency};
    double *const low[] = {&p->low.recovery, &p->low.oversize_loss, &p->low.misplaced_overflow,
                           &p->low.misplaced_underflow, &p->low.efficiency};
    double *const high[] = {&p->high.recovery, &p->high.oversize_loss, &p->high.misplaced_overflow,
                            &p->high.misplaced_underflow, &p->high.efficiency};
    for (int k = 0; k < 5; k++) {
        const double moved = exact[k] - *value[k];
        *value[k] = exact[k];
        *low[k] = *low[k] + moved < 0.0 && k < 4 ? 0.0 : *low[k] + moved; /* a share; NaN stays */
        *high[k] = *high[k] + moved > 1.0 ? 1.0 : *high[k] + moved;
    }
}

static void measure(separation *p) {
    double size[CLASSES] = {0.0}, mass[CLASSES] = {0.0}, share[CLASSES] = {0.0}, deviation[CLASSES] = {0.0};
    int n = 0;
    for (int k = 0; k < p->n; k++) {
        const split_class *c = &p->class[k];
        if (isnan(c->share)) continue;
        const double all = c->fine.mass + c->coarse.mass;
        if (n > 0 && !(c->size > size[n - 1])) { /* two classes of one mean size are one point */
            share[n - 1] = (share[n - 1] * mass[n - 1] + c->share * all) / (mass[n - 1] + all), mass[n - 1] += all;
            continue;
        }
        const double number = floor(c->fine.count + c->coarse.count + 0.5),
                     p1 = (c->share * number + 1.0) / (number + 2.0);
        size[n] = c->size, mass[n] = all, share[n] = c->share;
        deviation[n++] = sqrt(p1 * (1.0 - p1) / (number + 3.0));
    }
    p->full = n;
    const double cut = p->cut > 0.0 ? p->cut : 1.0;
    screen_measure(n, size, mass, share, cut, &p->value);
    screen_measure_range(n, size, mass, NULL, share, deviation, cut, 1, NULL, &p->low, &p->high);
    p->reached = p->value.ecart == p->value.ecart;
    if (n > 0) count_by_cut(p);
}

separation *scene_separation(const scene *s) {
    if (!s->def->measure.separation.part.where) return NULL;
    separation *p = calloc(1, sizeof *p);
    if (p) p->class = calloc((size_t)s->groups + 1, sizeof *p->class);
    if (!p || !p->class) return free(p), NULL;
    p->cut = scene_cut(s);
    p->time = scene_time(s) - s->def->measure.separation.from;
    count_classes(s, p);
    for (int k = 0; k < p->n; k++) find_share(&p->class[k]);
    qsort(p->class, (size_t)p->n, sizeof *p->class, smaller_first);
    if (p->n > CLASSES) p->n = CLASSES;
    measure(p);
    return p;
}

void scene_separation_free(separation *p) {
    if (p) free(p->class);
    free(p);
}

static const char separation_head[] = "low_m,high_m,size_m,fed_kg,fine_kg,coarse_kg,particles,to_coarse,low95,high95\n";

static void write_separation(const separation *p, riddle_io_file *file) {
    riddle_io_print(file, "%s", separation_head);
    for (int k = 0; k < p->n; k++) {
        const split_class *c = &p->class[k];
        const double row[] = {c->low,
                              c->high, /* an empty cell where it is open */
                              c->size,
                              c->fed.mass,
                              c->fine.mass,
                              c->coarse.count < 0.5 ? 0.0 : c->coarse.mass,
                              floor(c->fine.count + c->coarse.count + 0.5),
                              c->share,
                              c->share_low,
                              c->share_high};
        riddle_io_row(file, row, (int)(sizeof row / sizeof *row));
    }
}

static int draw_separation(const scene *s, const separation *p, const char *folder) {
    double x[CLASSES], y[CLASSES], low[CLASSES], high[CLASSES];
    char text[60];
    int n = 0;
    for (int k = 0; k < p->n; k++) {
        const split_class *c = &p->class[k];
        if (!isnan(c->share)) x[n] = 1e3 * c->size, y[n] = c->share, low[n] = c->share_low, high[n++] = c->share_high;
    }
    riddle_plot *plot = riddle_plot_new(s->def->title, 1, 1);
    riddle_plot_panel(plot, 0, 0, "particle size [mm]", "share to the coarse product [-]");
    riddle_plot_range_y(plot, 0.0, 1.02);
    if (n > 1) riddle_plot_band(plot, "95 % by number", x, low, high, n);
    if (n > 1) riddle_plot_line(plot, NULL, x, y, n);
    riddle_plot_points(plot, "classes", x, y, n);
    if (p->value.d50 > 0.0) {
        snprintf(text, sizeof text, "d50 = %.3g mm", 1e3 * p->value.d50);
        riddle_plot_vertical(plot, text, 1e3 * p->value.d50);
    }
    if (p->cut > 0.0 && n > 1 && 1e3 * p->cut > x[0] && 1e3 * p->cut < x[n - 1]) {
        snprintf(text, sizeof text, "cut asked for, %.3g mm", 1e3 * p->cut);
        riddle_plot_vertical(plot, text, 1e3 * p->cut);
    }
    return riddle_plot_write(plot, folder, "partition.svg") != RIDDLE_IO_OK;
}

/* ---- numbers with names ---- */

typedef void result_fn(void *user, const char *name, double value, double low, double high, const char *what);

static void visit_separation(const separation *p, result_fn *visit, void *user) {
    const screen_separation *v = &p->value, *l = &p->low, *h = &p->high;
    double fine = 0.0, coarse = 0.0;
    for (int k = 0; k < p->n; k++) fine += p->class[k].fine.mass, coarse += p->class[k].coarse.mass;
    visit(user, "d50_m", v->d50, l->d50, h->d50,
          "half goes to the coarse product; linear between mean sizes of classes");
    visit(user, "d25_m", v->d25, l->d25, h->d25, "a quarter does");
    visit(user, "d75_m", v->d75, l->d75, h->d75, "three quarters do");
    visit(user, "probable_error_m", v->ecart, l->ecart, h->ecart, "Ep = (d75 - d25)/2");
    visit(user, "imperfection", v->imperfection, l->imperfection, h->imperfection, "Ep/d50");
    visit(user, "cut_m", p->cut, none, none, "finer is undersize");
    visit(user, "recovery", v->recovery, l->recovery, h->recovery, "undersize in the fine product / undersize in both");
    visit(user, "oversize_loss", v->oversize_loss, l->oversize_loss, h->oversize_loss,
          "oversize in the fine product / oversize in both");
    visit(user, "efficiency", v->efficiency, l->efficiency, h->efficiency, "Hancock: recovery - oversize_loss");
    visit(user, "misplaced_in_coarse", v->misplaced_overflow, l->misplaced_overflow, h->misplaced_overflow,
          "undersize in the coarse product / all of it");
    visit(user, "misplaced_in_fine", v->misplaced_underflow, l->misplaced_underflow, h->misplaced_underflow,
          "oversize in the fine product / all of it");
    visit(user, "fine_yield", fine + coarse > 0.0 ? fine / (fine + coarse) : none, none, none, "fine product / both");
    visit(user, "fine_t_per_h", p->time > 0.0 ? 3.6 * fine / p->time : none, none, none,
          "mean flow of the fine product");
    visit(user, "coarse_kg", coarse, none, none, "coarse product");
    visit(user, "fine_kg", fine, none, none, "fine product");
}

static void visit_exits(const scene *s, result_fn *visit, void *user) {
    const wall_def *w = s->def->walls.item;
    char name[NAME];
    for (int k = 0; k < s->def->walls.n; k++) {
        tally sum = {0};
        if (!rows_is_exit(s, k)) continue;
        for (int g = 0; g < s->groups; g++) add(&sum, scene_left(s, s->wall_of[k], g), 1.0);
        const double mean = sum.mass > 0.0 ? sum.aged / sum.mass : none;
        snprintf(name, sizeof name, "%.60s_t_per_h", w[k].part.name);
        visit(user, name, scene_time(s) > 0.0 ? 3.6 * sum.mass / scene_time(s) : none, none, none,
              "mean flow over the whole run");
        snprintf(name, sizeof name, "%.60s_residence_s", w[k].part.name);
        visit(user, name, mean, none, none, "mean by mass of the time from being fed to passing");
        snprintf(name, sizeof name, "%.60s_residence_deviation_s", w[k].part.name);
        visit(user, name, sum.mass > 0.0 ? sqrt(fmax(sum.aged2 / sum.mass - mean * mean, 0.0)) : none, none, none,
              "standard deviation of that");
    }
}

static void visit_walls(const scene *s, result_fn *visit, void *user) {
    const wall_def *w = s->def->walls.item;
    char name[NAME];
    for (int k = 0; k < s->def->walls.n; k++) {
        const dem_wall *wall = &s->world.wall[s->wall_of[k]];
        if (rows_is_exit(s, k)) continue;
        for (int c = 0; c < 3; c++) {
            snprintf(name, sizeof name, "%.60s_impulse_%c_N_s", w[k].part.name, "xyz"[c]);
            visit(user, name, dem_axis(wall->impulse, c), none, none, "time integral of the force");
        }
        if (rows_turns(s, k)) {
            dem_vec point, axis;
            rows_axis(s, k, &point, &axis);
            const dem_vec all = dem_wall_angular_impulse(&s->world, s->wall_of[k], point);
            snprintf(name, sizeof name, "%.60s_angular_impulse_N_m_s", w[k].part.name);
            visit(user, name, all.x * axis.x + all.y * axis.y + all.z * axis.z, none, none,
                  "time integral of the torque about its axis");
        }
        if (!rows_moves(s, k)) continue;
        snprintf(name, sizeof name, "%.60s_work_J", w[k].part.name);
        visit(user, name, wall->work, none, none, "done on the particles by its motion");
    }
}

static heap_slope slope_now(const scene *s, const heap_def *h) {
    const dem_vec g = scene_vec(s->def->gravity);
    const double pull = sqrt(g.x * g.x + g.y * g.y + g.z * g.z);
    return heap_slope_of(&s->world, scene_vec(h->centre), dem_vec3(-g.x / pull, -g.y / pull, -g.z / pull), h->radius,
                         HUGE_VAL);
}
/* A heap is at rest while nothing in it is faster than a fall through a thousandth of its spheres' mean
   diameter gives. */
static const char *heap_state(const heap_slope *slope) {
    return slope->rings < 4      ? "too few rings are filled"
           : slope->speed > 0.01 ? "the heap still moves"
                                 : "the heap is at rest";
}

static void visit_last(const row_table *r, result_fn *visit, void *user) {
    const measure_def *m = &r->s->def->measure;
    const heap_def *h = m->heaps.item;
    for (int k = 0; k < m->mixing.n && r->n > 0; k++)
        visit(user, r->column[r->mixing_from + k].name, rows_at(r, r->n - 1, r->mixing_from + k), none, none,
              "Lacey's index at the end: (s0^2 - s^2)/(s0^2 - sr^2)");
    for (int k = 0; k < m->heaps.n && r->n > 0; k++) {
        const heap_slope slope = slope_now(r->s, &h[k]);
        visit(user, r->column[r->heaps_from + k].name, rows_at(r, r->n - 1, r->heaps_from + k), none, none,
              heap_state(&slope));
    }
}

static void visit_all(const row_table *r, const separation *p, result_fn *visit, void *user) {
    if (p) visit_separation(p, visit, user);
    visit_exits(r->s, visit, user);
    visit_walls(r->s, visit, user);
    visit_last(r, visit, user);
}

static void write_result(void *user, const char *name, double value, double low, double high, const char *what) {
    const double row[3] = {value, low, high};
    riddle_io_print(user, "%s,%s,", name, what);
    riddle_io_row(user, row, 3);
}
static void json_result(void *user, const char *name, double value, double low, double high, const char *what) {
    json_object_begin(user, name);
    json_number(user, "value", value);
    if (low == low) json_number(user, "low95", low), json_number(user, "high95", high);
    json_string(user, "what", what);
    json_object_end(user);
}

void scene_results_write(const row_table *r, const separation *p, const char *folder,
                         void (*wrote)(void *user, const char *name), void *user) {
    riddle_io_file *file = riddle_io_open(folder, "results.csv");
    riddle_io_print(file, "result,what,value,low95,high95\n");
    visit_all(r, p, write_result, file);
    if (riddle_io_close(file) == RIDDLE_IO_OK) wrote(user, "results.csv");
    if (!p) earlier_remove(folder, "separation.csv", separation_head);
    if (!p || p->full <= 0) earlier_remove(folder, "partition.svg", "<svg ");
    if (!p) return;
    file = riddle_io_open(folder, "separation.csv");
    write_separation(p, file);
    if (riddle_io_close(file) == RIDDLE_IO_OK) wrote(user, "separation.csv");
    if (p->full > 0 && draw_separation(r->s, p, folder) == 0) wrote(user, "partition.svg");
}

void scene_results_json(const row_table *r, const separation *p, json *j) {
    if (!j) return;
    json_object_begin(j, "results");
    visit_all(r, p, json_result, j);
    json_object_end(j);
    if (!p) return;
    json_array_begin(j, "separation");
    for (int k = 0; k < p->n; k++) {
        const split_class *c = &p->class[k];
        json_object_begin(j, NULL);
        json_number(j, "low_m", c->low), json_number(j, "high_m", c->high), json_number(j, "size_m", c->size);
        json_number(j, "fed_kg", c->fed.mass), json_number(j, "fine_kg", c->fine.mass),
            json_number(j, "coarse_kg", c->coarse.mass);
        json_number(j, "to_coarse", c->share);
        json_object_end(j);
    }
    json_array_end(j);
}

void scene_results_say(const row_table *r, const separation *p) {
    const heap_def *h = r->s->def->measure.heaps.item;
    if (p) {
        const screen_separation *v = &p->value;
        if (v->d50 == v->d50) common_print("separation: d50 %.4g mm", 1e3 * v->d50);
        else common_print("separation: no d50 (the curve of %d classes does not rise through one half)", p->full);
        if (v->d50 == v->d50 && p->low.d50 == p->low.d50)
            common_print(" (%.4g to %.4g)", 1e3 * p->low.d50, 1e3 * p->high.d50);
        if (p->reached) common_print(", Ep %.3g mm", 1e3 * v->ecart);
        if (v->efficiency == v->efficiency)
            common_print(", efficiency %.3g at %.4g mm (Hancock)", v->efficiency, 1e3 * p->cut);
        common_print("\n");
    }
    for (int k = 0; k < r->s->def->measure.heaps.n; k++) {
        const heap_slope slope = slope_now(r->s, &h[k]);
        if (slope.rings >= 4)
            common_print("%s: %.3g degrees; %s\n", h[k].part.name, slope.angle * 180.0 / RIDDLE_PI, heap_state(&slope));
        else common_print("%s: no angle: %s\n", h[k].part.name, heap_state(&slope));
    }
}
