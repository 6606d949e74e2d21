/* deck_report.h - what screen_deck has found, as tables, figures, a picture of the machine, CSV, JSON and
   ParaView files. */
#ifndef DECK_REPORT_H
#define DECK_REPORT_H

#include "common.h"
#include "deck_models.h"

enum { RUNS = 2 };

typedef struct deck_run {
    deck_def def;
    deck_machine deck;
    deck_books books;
    dem_status status;
    int first, end; /* windows that were measured */
    deck_answer answer[DECKS_MAX];
    ptrdiff_t present[DECK_CLASSES]; /* grains in the machine at the end, by class */
    double liquid_error;
    deck_curves curves;
    double predicted[DECK_MODELS][DECK_CLASSES * DECK_STATIONS], deviation[DECK_MODELS];
    double length_by_dem, length_by_model[DECK_MODELS]; /* for the wanted recovery [m] */
    double efficiency[DECK_MODELS],
        capacity[DECK_MODELS]; /* by model: share of the undersize that passes [-]; feed for the recovery [kg/s] */
} deck_run;

typedef struct study {
    deck_run run[RUNS];
    int runs, models;
    deck_fit fit[DECK_MODELS];
    double window, measure, tolerance, recovery, left_out, machine_width, load_exponent;
    bool frames;
    const program *self;
    progress bar;
} study;

/* [t/h] */
static double tons(const study *st, const deck_run *r, double flow) {
    return 3.6 * flow * st->machine_width / r->def.width;
}

/* Grains of a class that were fed and are neither in the machine nor in a product: 0. */
static ptrdiff_t missing(const deck_run *r, int c) {
    ptrdiff_t n = r->books.fed[c] - r->present[c];
    for (int k = 0; k <= r->def.decks; k++) n -= r->books.left[k][c];
    return n;
}

static screen_separation separation_of(const deck_run *r, int level) {
    const deck_answer *a = &r->answer[level];
    screen_separation s;
    double size[DECK_CLASSES] = {0.0}, feed[DECK_CLASSES], partition[DECK_CLASSES];
    int n = 0;
    for (int c = 0; c < r->books.classes.count; c++)
        if (a->arrived[c] > 0.0) size[n] = a->size[c], feed[n] = a->arrived[c], partition[n++] = a->partition[c].value;
    screen_measure(n, size, feed, partition, r->def.aperture[level], &s);
    return s;
}

/* ---- ParaView ---- */

/* From the deck's frame to the level one. */
static dem_vec level_of(const deck_def *d, dem_vec v) {
    const double c = cos(d->inclination), s = sin(d->inclination);
    return dem_vec3(v.x * c + v.z * s, v.y, v.z * c - v.x * s);
}

static void write_frame(const deck_run *r, const char *folder, riddle_io_series *series) {
    const dem_world *world = &r->deck.world;
    const ptrdiff_t n = world->count;
    double *buffer = malloc((size_t)(7 * n + 1) * sizeof *buffer), *x = buffer, *v = buffer + 3 * n,
           *size = buffer + 6 * n;
    int *klass = malloc((size_t)(2 * n + 2) * sizeof *klass), *level = klass + n, m = 0;
    for (ptrdiff_t i = 0; i < n && buffer && klass; i++) {
        if (!world->alive[i]) continue;
        const dem_vec at = level_of(&r->def, dem_position(world, i)), u = level_of(&r->def, dem_velocity(world, i));
        x[3 * m] = at.x, x[3 * m + 1] = at.y, x[3 * m + 2] = at.z;
        v[3 * m] = u.x, v[3 * m + 1] = u.y, v[3 * m + 2] = u.z;
        size[m] = 2.0 * dem_radius(world, i);
        level[m] = r->books.grain[world->id[i]].level;
        klass[m++] = r->books.grain[world->id[i]].klass;
    }
    const riddle_io_array arrays[] = {riddle_io_scalar("diameter_m", size), riddle_io_vector("velocity_m_s", v),
                                      riddle_io_ints("class", klass), riddle_io_ints("deck", level)};
    if (buffer && klass)
        riddle_io_points(folder, riddle_io_series_name(series, world->time), m, riddle_io_vector("position", x), arrays,
                         4);
    else common_fail("out of memory for a frame");
    free(buffer);
    free(klass);
}

/* ---- a picture from the side ---- */

static const char *const grain_name[5] = {"under half the aperture", "0.5 to 0.8", "near-mesh, 0.8 to 1", "1 to 1.5",
                                          "over 1.5 times the aperture"};
static const int grain_colour[5] = {5, 0, 1, 2, 6};
static int grain_kind(double share) {
    return share < 0.5 ? 0 : share < 0.8 ? 1 : share < 1.0 ? 2 : share < 1.5 ? 3 : 4;
}

/* Wires of a deck, or bars of slots across, in section: x, z, radius [mm] of the first `most`. Returns their number. */
static int wires_of(const deck_run *r, int level, double *x, double *z, double *radius, int most) {
    const deck_def *d = &r->def;
    const dem_wall *wall = &r->deck.world.wall[level];
    const double pitch = d->mesh == DECK_SLOTS_ALONG ? d->slot_length + d->wire[level] : deck_pitch(d, level);
    int n = 0;
    if (d->mesh == DECK_SLOTS_ALONG && d->slot_length <= 0.0) return 0;
    for (double along = 0.0; along <= d->length + 0.5 * pitch && n < most; along += pitch) {
        const dem_vec at =
            level_of(d, dem_vec3(along + wall->position.x - wall->asked.origin.x, 0.0, wall->position.z));
        x[n] = 1e3 * at.x, z[n] = 1e3 * at.z, radius[n++] = 0.5e3 * d->wire[level];
    }
    return n;
}

/* A slice as thick as one and a half of the largest grains, as it is at the end of the run; wires or
   bars in section. */
static void draw_machine(const study *st, const deck_run *r, const char *name) {
    enum { WIRES = 4000 };
    const deck_def *d = &r->def;
    const dem_world *world = &r->deck.world;
    const double slice = 1.5 * deck_largest(&d->sizes), c = cos(d->inclination), s = sin(d->inclination);
    const double above = r->deck.feed.region.high.z + 0.01, below = deck_height(d, d->decks - 1) - 0.04;
    const double width = d->length * c + (above - below) * s, height = (above - below) * c + d->length * s;
    const int room = (int)world->count > WIRES ? (int)world->count : WIRES;
    double *x = malloc((size_t)room * 3 * sizeof *x), *z = x + room, *radius = z + room;
    if (!x) {
        common_fail("out of memory for %s", name);
        return;
    }
    riddle_plot *figure = riddle_plot_new("From the side, at the end of the run", 1, 1);
    riddle_plot_panel_size(figure, 1000.0, fmin(1000.0 * height / width, 2000.0));
    riddle_plot_scale_bar(figure, "mm");
    riddle_plot_range_x(figure, 1e3 * below * s, 1e3 * (below * s + width));
    riddle_plot_range_y(figure, 1e3 * (above * c - height), 1e3 * above * c);
    for (int q = 0; q < 5; q++) {
        int n = 0;
        for (ptrdiff_t i = 0; i < world->count; i++) {
            const dem_vec place = dem_position(world, i), at = level_of(d, place);
            const double own = dem_radius(world, i);
            if (!world->alive[i] || !(place.y >= 0.0 && place.y < slice) || grain_kind(2.0 * own / d->aperture[0]) != q)
                continue;
            x[n] = 1e3 * at.x, z[n] = 1e3 * at.z, radius[n++] = 1e3 * own;
        }
        riddle_plot_discs(figure, grain_name[q], x, z, radius, n);
        riddle_plot_style(figure, 0, grain_colour[q]);
    }
    for (int k = 0; k < d->decks; k++) {
        riddle_plot_discs(figure, NULL, x, z, radius, wires_of(r, k, x, z, radius, WIRES));
        riddle_plot_style(figure, 0, RIDDLE_PLOT_BLACK);
    }
    free(x);
    riddle_plot_write(figure, st->self->out, name);
}

/* ---- figures ---- */

static void feed_label(const study *st, const deck_run *r, char *text, size_t size) {
    snprintf(text, size, "%.4g t/h", tons(st, r, r->def.flow));
}

/* Of the models the one that predicts the second run best is drawn, or fits the first best. */
static int best_model(const study *st) {
    int best = -1;
    for (int m = 0; m < st->models; m++) {
        const double *of = st->run[st->runs - 1].deviation;
        if (of[m] < (best < 0 ? HUGE_VAL : of[best])) best = m;
    }
    return best;
}

static void draw_partition(const study *st) {
    riddle_plot *figure = riddle_plot_new("Partition curve of the first deck, 95 % bands", 1, 1);
    const int best = best_model(st);
    char text[80];
    riddle_plot_panel(figure, 0, 0, "diameter [mm]", "share that leaves over the end [-]");
    riddle_plot_range_y(figure, 0.0, 1.02);
    for (int k = 0; k < st->runs; k++) {
        const deck_run *r = &st->run[k];
        double x[DECK_CLASSES], y[DECK_CLASSES], low[DECK_CLASSES], high[DECK_CLASSES], model[DECK_CLASSES];
        int n = 0;
        for (int c = 0; c < r->books.classes.count; c++) {
            const deck_estimate p = r->answer[0].partition[c];
            if (isnan(p.value)) continue;
            x[n] = 1e3 * r->answer[0].size[c], y[n] = p.value;
            low[n] = fmax(p.value - p.interval, 0.0), high[n++] = fmin(p.value + p.interval, 1.0);
        }
        feed_label(st, r, text, sizeof text);
        riddle_plot_line(figure, text, x, y, n), riddle_plot_style(figure, RIDDLE_PLOT_MARKED, k);
        riddle_plot_band(figure, NULL, x, low, high, n), riddle_plot_style(figure, 0, k);
        if (best < 0 || r->curves.points < 1) continue;
        for (int c = 0; c < r->curves.classes; c++) {
            x[c] = 1e3 * r->curves.diameter[c];
            model[c] = r->predicted[best][(c + 1) * r->curves.points - 1];
        }
        snprintf(text, sizeof text, "model %s, %s", deck_model_name[best], k ? "predicted" : "fitted");
        riddle_plot_line(figure, text, x, model, r->curves.classes), riddle_plot_style(figure, RIDDLE_PLOT_DASHED, k);
    }
    riddle_plot_vertical(figure, NULL, 1e3 * st->run[0].def.aperture[0]);
    riddle_plot_text(figure, 1.01e3 * st->run[0].def.aperture[0], 0.03, "aperture");
    riddle_plot_write(figure, st->self->out, "partition.svg");
}

static void draw_along(const study *st) {
    riddle_plot *figure = riddle_plot_new("Along the first deck, steady", 2, 2);
    static const char *const label[4] = {"load [kg/m\xc2\xb2]", "velocity along the deck [m/s]", "bed depth [mm]",
                                         "blocked holes [%]"};
    char text[80];
    double blocked = 0.0;
    for (int k = 0; k < st->runs; k++)
        for (int z = 0; z < DECK_ZONES; z++) blocked = fmax(blocked, st->run[k].answer[0].held[z].value);
    if (!(blocked > 0.0)) common_print("No hole of the first deck was blocked: along.svg has no panel for that.\n");
    for (int q = 0; q < (blocked > 0.0 ? 4 : 3); q++) {
        riddle_plot_panel(figure, q / 2, q % 2, "length [m]", label[q]);
        for (int k = 0; k < st->runs; k++) {
            const deck_run *r = &st->run[k];
            const deck_answer *a = &r->answer[0];
            double x[DECK_ZONES], y[DECK_ZONES], interval[DECK_ZONES], most = 0.0;
            for (int z = 0; z < DECK_ZONES; z++) {
                x[z] = (z + 0.5) * r->def.length / DECK_ZONES;
                y[z] = q == 0   ? a->load[z]
                       : q == 1 ? a->velocity[z]
                       : q == 2 ? 1e3 * a->depth[z]
                                : 1e2 * a->held[z].value;
                interval[z] = 1e2 * a->held[z].interval;
                most = fmax(most, y[z]);
            }
            feed_label(st, r, text, sizeof text);
            if (q == 3) riddle_plot_error_bars(figure, text, x, y, interval, DECK_ZONES);
            else riddle_plot_line(figure, text, x, y, DECK_ZONES);
            riddle_plot_style(figure, q == 3 ? 0 : RIDDLE_PLOT_MARKED, k);
            if (k == 0 && most > 0.0) riddle_plot_range_y(figure, 0.0, 1.25 * most);
        }
    }
    riddle_plot_write(figure, st->self->out, "along.svg");
}

/* Retained by class along the way from the feed: DEM as points, models as lines; fitted left, predicted right. */
static void draw_models(const study *st) {
    const int best = best_model(st);
    if (best < 0) return;
    char text[120];
    snprintf(text, sizeof text, "Retained along the deck: points DEM, lines model %s", deck_model_name[best]);
    riddle_plot *figure = riddle_plot_new(text, 1, st->runs);
    for (int k = 0; k < st->runs; k++) {
        const deck_run *r = &st->run[k];
        const deck_curves *c = &r->curves;
        riddle_plot_panel(figure, 0, k, "way from the feed [m]", "share retained [-]");
        snprintf(text, sizeof text, "%.4g t/h, %s", tons(st, r, r->def.flow), k ? "predicted" : "fitted");
        riddle_plot_title(figure, text);
        riddle_plot_range_y(figure, 0.0, 1.02);
        for (int q = 0; q < c->classes; q++) {
            snprintf(text, sizeof text, "%.3g mm", 1e3 * c->diameter[q]);
            riddle_plot_points(figure, text, c->length, c->retained + q * c->points, c->points),
                riddle_plot_style(figure, 0, q % 8);
            riddle_plot_line(figure, NULL, c->length, r->predicted[best] + q * c->points, c->points),
                riddle_plot_style(figure, 0, q % 8);
        }
        riddle_plot_legend_outside(figure);
    }
    riddle_plot_write(figure, st->self->out, "models.svg");
}

static void draw_steady(const study *st) {
    riddle_plot *figure =
        riddle_plot_new("In, out and hold-up in time; from the line on the deck is steady", 2, st->runs);
    for (int k = 0; k < st->runs; k++) {
        const deck_run *r = &st->run[k];
        const int n = (int)r->books.windows;
        double *t = calloc((size_t)n + 1, 4 * sizeof *t), *in = t + n, *out = in + n, *hold = out + n;
        char text[60];
        for (int w = 0; w < n && t; w++) {
            t[w] = (w + 0.5) * st->window;
            in[w] = tons(st, r, r->books.window[w].fed / st->window),
            out[w] = tons(st, r, r->books.window[w].left / st->window);
            hold[w] = r->books.window[w].looks ? r->books.window[w].holdup / r->books.window[w].looks : 0.0;
        }
        riddle_plot_panel(figure, 0, k, "time [s]", "mass flow [t/h]");
        feed_label(st, r, text, sizeof text);
        riddle_plot_title(figure, text);
        if (t) riddle_plot_line(figure, "in", t, in, n), riddle_plot_line(figure, "out", t, out, n);
        if (r->books.steady >= 0) riddle_plot_vertical(figure, "steady", r->books.steady * st->window);
        riddle_plot_panel(figure, 1, k, "time [s]", "hold-up of the section [kg]");
        if (t) riddle_plot_line(figure, NULL, t, hold, n);
        if (r->books.steady >= 0) riddle_plot_vertical(figure, "steady", r->books.steady * st->window);
        free(t);
    }
    riddle_plot_write(figure, st->self->out, "steady.svg");
}

/* ---- tables and files ---- */

static void print_decks(const study *st) {
    static const result_column columns[] = {{NULL, "feed [t/h]", "%.4g"},
                                            {NULL, "deck", "%.0f"},
                                            {NULL, "aperture [mm]", "%.3g", 1e3},
                                            {NULL, "grains", "%.0f"},
                                            {NULL, "over [t/h]", "%.2f"},
                                            {NULL, "+- 95 %", "%.2f"},
                                            {NULL, "through [t/h]", "%.2f"},
                                            {NULL, "+-", "%.2f"},
                                            {NULL, "undersize recovered", "%.3f"},
                                            {NULL, "+-", "%.3f"},
                                            {NULL, "undersize in over", "%.3f"},
                                            {NULL, "+-", "%.3f"},
                                            {NULL, "oversize through", "%.4f"},
                                            {NULL, "+-", "%.4f"},
                                            {NULL, "d50 [mm]", "%.2f", 1e3},
                                            {NULL, "imperfection", "%.3f"},
                                            {NULL, "stay [s]", "%.2f"},
                                            {NULL, "10 %", "%.2f"},
                                            {NULL, "90 %", "%.2f"}};
    result_table *t = RESULTS(columns);
    for (int k = 0; k < st->runs; k++) {
        const deck_run *r = &st->run[k];
        double grains = 0.0;
        for (int w = r->first; w < r->end; w++)
            grains += r->books.window[w].grains / r->books.window[w].looks / (r->end - r->first);
        for (int q = 0; q < r->def.decks; q++) {
            const deck_answer *a = &r->answer[q];
            const screen_separation s = separation_of(r, q);
            results_row(t, NULL, tons(st, r, r->def.flow), q + 1, r->def.aperture[q], grains,
                        tons(st, r, a->over.value), tons(st, r, a->over.interval), tons(st, r, a->under.value),
                        tons(st, r, a->under.interval), a->recovery.value, a->recovery.interval,
                        a->undersize_in_over.value, a->undersize_in_over.interval, a->oversize_in_under.value,
                        a->oversize_in_under.interval, s.d50, s.imperfection, a->stay, a->stay_low, a->stay_high);
        }
    }
    results_print(t);
    results_free(t);
}

static void print_partition(const study *st) {
    static const result_column columns[] = {{NULL, "diameter [mm]", "%.2f", 1e3},
                                            {NULL, "share of the feed", "%.3f"},
                                            {NULL, "over the end", "%.3f"},
                                            {NULL, "+-", "%.3f"},
                                            {NULL, "model", "%.3f"},
                                            {NULL, "second feed: over the end", "%.3f"},
                                            {NULL, "+-", "%.3f"},
                                            {NULL, "model", "%.3f"}};
    const int best = best_model(st);
    const deck_run *first = &st->run[0];
    result_table *t = results_new(columns, 2 + 3 * st->runs);
    double all = 0.0;
    for (int c = 0; c < first->books.classes.count; c++) all += first->answer[0].arrived[c];
    for (int c = 0; c < first->books.classes.count; c++) {
        double row[2 + 3 * RUNS] = {first->answer[0].size[c], first->answer[0].arrived[c] / all};
        for (int k = 0; k < st->runs; k++) {
            const deck_curves *q = &st->run[k].curves;
            double *of_run = row + 2 + 3 * k;
            of_run[0] = st->run[k].answer[0].partition[c].value, of_run[1] = st->run[k].answer[0].partition[c].interval;
            of_run[2] = (double)NAN;
            for (int m = 0; m < q->classes && best >= 0; m++)
                if (q->klass[m] == c) of_run[2] = st->run[k].predicted[best][(m + 1) * q->points - 1];
        }
        results_add(t, NULL, row, 2 + 3 * st->runs);
    }
    results_print(t);
    results_free(t);
}

/* Share of the undersize that has passed at the last station [-]. */
static double recovered_by_dem(const deck_run *r) {
    return r->curves.points > 0 ? r->curves.recovery[r->curves.points - 1] : (double)NAN;
}

static void print_models(const study *st) {
    char heading[80], name[40];
    snprintf(heading, sizeof heading, "deck area for %.3g of the undersize by", st->recovery);
    const result_column columns[] = {{NULL, heading, "%s"},
                                     {NULL, "deviation, first feed (fitted)", "%.4f"},
                                     {NULL, "second feed (predicted)", "%.4f"},
                                     {NULL, "area, first feed [m2]", "%.2f"},
                                     {NULL, "second feed [m2]", "%.2f"},
                                     {NULL, "passed at its end, first", "%.3f"},
                                     {NULL, "second", "%.3f"},
                                     {NULL, "largest feed [t/h]", "%.3g"}};
    const deck_run *first = &st->run[0], *last = &st->run[st->runs - 1];
    const double width = st->machine_width;
    result_table *t = RESULTS(columns);
    results_row(t, TEXTS("DEM"), NAN, NAN, width * first->length_by_dem, width * last->length_by_dem,
                recovered_by_dem(first), recovered_by_dem(last), NAN);
    for (int m = 0; m < st->models; m++) {
        if (st->fit[m].status != SCREEN_OK) continue;
        snprintf(name, sizeof name, "model %s", deck_model_name[m]);
        results_row(t, TEXTS(name), first->deviation[m], st->runs > 1 ? last->deviation[m] : (double)NAN,
                    width * first->length_by_model[m], width * last->length_by_model[m], first->efficiency[m],
                    last->efficiency[m], tons(st, first, first->capacity[m]));
    }
    results_print(t);
    results_free(t);
}

static void write_tables(const study *st) {
    result_table *classes = results_of("feed_t_h,deck,diameter_m,arrived_kg_s,over,interval_95"),
                 *curves = results_of("feed_t_h,deck,length_m,diameter_m,retained"),
                 *zones = results_of(
                     "feed_t_h,deck,length_m,load_kg_m2,depth_m,velocity_m_s,blocked,blocked_interval_95,occupied,"
                     "occupied_interval_95");
    for (int k = 0; k < st->runs; k++)
        for (int q = 0; q < st->run[k].def.decks; q++) {
            const deck_run *r = &st->run[k];
            const deck_answer *a = &r->answer[q];
            const double feed = tons(st, r, r->def.flow), number = q + 1;
            for (int c = 0; c < r->books.classes.count; c++) {
                results_row(classes, NULL, feed, number, a->size[c], a->arrived[c] / a->duration, a->partition[c].value,
                            a->partition[c].interval);
                for (int s = 0; s < DECK_STATIONS; s++)
                    results_row(curves, NULL, feed, number, (s + 1) * r->def.length / DECK_STATIONS, a->size[c],
                                a->retained[c][s]);
            }
            for (int z = 0; z < DECK_ZONES; z++)
                results_row(zones, NULL, feed, number, (z + 0.5) * r->def.length / DECK_ZONES, a->load[z], a->depth[z],
                            a->velocity[z], a->held[z].value, a->held[z].interval, a->sitting[z].value,
                            a->sitting[z].interval);
        }
    results_csv(classes, st->self->out, "partition.csv"), results_free(classes);
    results_csv(zones, st->self->out, "along.csv"), results_free(zones);
    results_csv(curves, st->self->out, "retained.csv"), results_free(curves);
}

static void json_estimate(json *j, const char *key, deck_estimate e) {
    json_object_begin(j, key);
    json_number(j, "value", e.value);
    json_number(j, "interval_95", e.interval);
    json_object_end(j);
}

static void json_deck(json *j, const deck_run *r, int q) {
    const deck_answer *a = &r->answer[q];
    const screen_separation s = separation_of(r, q);
    const int classes = r->books.classes.count;
    double value[DECK_CLASSES], interval[DECK_CLASSES], blocked[DECK_ZONES];
    json_object_begin(j, NULL);
    json_number(j, "aperture_m", r->def.aperture[q]);
    json_number(j, "wire_m", r->def.wire[q]);
    json_estimate(j, "over_kg_s", a->over);
    json_estimate(j, "through_kg_s", a->under);
    json_estimate(j, "undersize_recovery", a->recovery);
    json_estimate(j, "undersize_in_over", a->undersize_in_over);
    json_estimate(j, "oversize_in_through", a->oversize_in_under);
    results_values(j, {"largest_through_m", a->largest_under}, {"d50_m", s.d50}, {"imperfection", s.imperfection},
                   {"efficiency_hancock", s.efficiency}, {"stay_mean_s", a->stay}, {"stay_10_s", a->stay_low},
                   {"stay_90_s", a->stay_high});
    for (int c = 0; c < classes; c++) value[c] = a->partition[c].value, interval[c] = a->partition[c].interval;
    for (int z = 0; z < DECK_ZONES; z++) blocked[z] = a->held[z].value;
    json_array(j, "diameter_m", a->size, classes);
    json_array(j, "partition", value, classes);
    json_array(j, "partition_interval_95", interval, classes);
    json_array(j, "load_kg_m2", a->load, DECK_ZONES);
    json_array(j, "depth_m", a->depth, DECK_ZONES);
    json_array(j, "velocity_m_s", a->velocity, DECK_ZONES);
    json_array(j, "blocked", blocked, DECK_ZONES);
    json_object_end(j);
}

static void json_balance(json *j, const deck_run *r) {
    int fed[DECK_CLASSES], present[DECK_CLASSES], product[DECK_CLASSES];
    const int classes = r->books.classes.count;
    char key[40];
    ptrdiff_t lost = 0;
    for (int c = 0; c < classes; c++)
        fed[c] = (int)r->books.fed[c], present[c] = (int)r->present[c], lost += labs((long)missing(r, c));
    json_object_begin(j, "grains");
    json_integers(j, "fed", fed, classes);
    json_integers(j, "in_the_machine", present, classes);
    for (int q = 0; q <= r->def.decks; q++) {
        for (int c = 0; c < classes; c++) product[c] = (int)r->books.left[q][c];
        if (q < r->def.decks) snprintf(key, sizeof key, "over_deck_%d", q + 1);
        json_integers(j, q < r->def.decks ? key : "underflow", product, classes);
    }
    json_integer(j, "placed", (long long)r->deck.feed.placed);
    json_integer(j, "missing", (long long)lost);
    json_object_end(j);
}

static void write_json(const study *st) {
    json *j = json_open(st->self->json);
    json_program(j, st->self);
    json_number(j, "fines_left_out", st->left_out);
    json_array_begin(j, "runs");
    for (int k = 0; k < st->runs; k++) {
        const deck_run *r = &st->run[k];
        char hash[20];
        json_object_begin(j, NULL);
        json_number(j, "feed_kg_s", r->def.flow);
        json_number(j, "feed_t_h", tons(st, r, r->def.flow));
        json_bool(j, "steady", r->books.steady >= 0);
        results_values(j, {"measured_from_s", r->first * st->window}, {"measured_to_s", r->end * st->window},
                       {"feed_behind_kg", r->deck.feed.due_mass});
        json_balance(j, r);
        json_array_begin(j, "decks");
        for (int q = 0; q < r->def.decks; q++) json_deck(j, r, q);
        json_array_end(j);
        results_values(j, {"dt_s", r->deck.world.def.dt}, {"deck_area_by_dem_m2", r->length_by_dem * st->machine_width},
                       {"recovered_by_dem", recovered_by_dem(r)},
                       {"particle_steps", (double)r->deck.world.particle_steps});
        if (r->deck.wet) json_number(j, "liquid_error_rel", r->liquid_error);
        snprintf(hash, sizeof hash, "%016llx", (unsigned long long)dem_hash(&r->deck.world));
        json_string(j, "hash", hash);
        json_object_end(j);
    }
    json_array_end(j);
    json_number(j, "recovery", st->recovery);
    json_array_begin(j, "models");
    for (int m = 0; m < st->models; m++) {
        json_object_begin(j, NULL);
        json_string(j, "model", deck_model_name[m]);
        json_string(j, "status", screen_status_text(st->fit[m].status));
        json_array(j, "parameters", st->fit[m].parameter, SCREEN_MAX_PARAMETERS);
        json_number(j, "deviation_fitted", st->run[0].deviation[m]);
        json_number(j, "deviation_predicted", st->runs > 1 ? st->run[1].deviation[m] : (double)NAN);
        for (int k = 0; k < st->runs; k++) {
            json_number(j, k ? "deck_area_second_m2" : "deck_area_first_m2",
                        st->run[k].length_by_model[m] * st->machine_width);
            json_number(j, k ? "recovered_second" : "recovered_first", st->run[k].efficiency[m]);
        }
        json_number(j, "largest_feed_t_h", tons(st, &st->run[0], st->run[0].capacity[m]));
        json_object_end(j);
    }
    json_array_end(j);
    json_close(j);
}

/* What a user has to know before believing the rest. */
static void warn(const study *st) {
    if (st->left_out > 1e-3)
        common_print("finer than --smallest-mm and left out: %.1f %% of the feed\n", 1e2 * st->left_out);
    for (int k = 0; k < st->runs; k++) {
        const deck_run *r = &st->run[k];
        const double feed = tons(st, r, r->def.flow),
                     behind = r->deck.feed.due_mass / (r->def.flow * r->deck.world.time);
        ptrdiff_t fed = 0, lost = 0;
        for (int c = 0; c < r->books.classes.count; c++) fed += r->books.fed[c], lost += labs((long)missing(r, c));
        if (r->books.steady >= 0)
            common_print("%.4g t/h: steady from %.2f s on, measured to %.2f s", feed, r->first * st->window,
                         r->end * st->window);
        else
            common_print(
                "%.4g t/h: NOT STEADY within %.2f s: overloaded, or --longest-s is too short; its second half is shown",
                feed, r->deck.world.time);
        common_print("; %td grains fed, %td missing\n", fed, lost);
        if (behind > 0.01) common_print("%.4g t/h: the feed found no room for %.1f %% of it\n", feed, 1e2 * behind);
        if (r->deck.wet) common_print("%.4g t/h: liquid conserved to %.1e\n", feed, r->liquid_error);
    }
}

static void report(const study *st) {
    double steps = 0.0;
    for (int k = 0; k < st->runs; k++) steps += (double)st->run[k].deck.world.particle_steps;
    common_print("toss indicator K = %.2f; section of %.4g mm, deck of %.4g m; %.3g particle-steps of %.3g us, %.0f s "
                 "of processor\n",
                 deck_toss(&st->run[0].def), 1e3 * st->run[0].def.width, st->run[0].def.length, steps,
                 1e6 * st->run[0].deck.world.def.dt, machine_processor_seconds());
    warn(st);
    print_decks(st);
    print_partition(st);
    if (st->models) print_models(st);
    draw_partition(st);
    draw_along(st);
    draw_models(st);
    draw_steady(st);
    draw_machine(st, &st->run[0], "machine.svg");
    write_tables(st);
    write_json(st);
}

#endif
