/* batch_screening - a batch of glass spheres on a vibrated sieve: the study of Elskamp & Kruggel-Emden (2019).

   1.41 kg of mixed spheres of 5, 7 and 10 mm lie on the floor of a feed bin. At t = 0 the floor is removed; they fall
   onto a woven screen with 8 mm apertures that vibrates along an ellipse, and the smaller two classes pass it. The
   program prints and draws the fraction retained by class over time, for one seed, or the mean of several with its
   interval.
   Studies: all 27 cases of the paper's table 5 (--all-cases), a case and its neighbours (--vary), the effect of
   moisture (--compare-moisture), and what the paper does not give (--sensitivity: diameter of the deck, drop height,
   outlet, profile of the bars, damping convention). docs/batch_screening.md gives the reasons for the defaults.
   For your own sieve: the options; sizes, materials and contacts stand in screening_scene.h (class_diameter, define()).

   screening_scene.h      the machine and one run      screening_study.h   runs with many seeds: their files, means,
                                                       intervals
   screening_findings.h   the paper's statements       this file           options, tables, pictures */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "screening_findings.h"

/* Curves of a variant: mean, and low and high end of what is asked for. */
typedef struct averages {
    double *time, *mean[CURVES], *sd[CURVES], *interval[CURVES]; /* [samples], one block */
} averages;

static int average(const study *st, int v, averages *a) {
    const size_t n = (size_t)st->samples;
    a->time = malloc(n * (1 + 3 * CURVES) * sizeof *a->time);
    if (!a->time) return common_fail("out of memory");
    for (size_t c = 0; c < CURVES; c++) {
        a->mean[c] = a->time + n * (1 + 3 * c);
        a->sd[c] = a->mean[c] + n;
        a->interval[c] = a->sd[c] + n;
    }
    for (int k = 0; k < st->samples; k++) {
        a->time[k] = k * SAMPLE;
        for (int c = 0; c < CURVES; c++) {
            const statistics s = measure_of(st, v, at_time(c, k * SAMPLE));
            a->mean[c][k] = s.mean, a->sd[c][k] = s.sd, a->interval[c][k] = s.interval;
        }
    }
    return 0;
}

/* ---- output of one variant ---- */

static const char *describe(char *text, size_t size, const settings *s) {
    char moisture[32] = "dry";
    if (s->moisture > 0.0) snprintf(moisture, sizeof moisture, "%.3g %% water", 100.0 * s->moisture);
    snprintf(text, size, "%.3g mm, %.3g Hz, %s", 1e3 * s->amplitude, s->frequency, moisture);
    return text;
}

/* A curve with its band where there are several seeds. */
static void plot_average(riddle_plot *figure, const char *label, const averages *a, int curve, int n, int seeds,
                         int colour, double highest) {
    const double unit = curve == H_STAR ? 1e3 : 1.0; /* heights in mm */
    double *low = malloc((size_t)n * 3 * sizeof *low), *high = low ? low + n : NULL, *mean = low ? high + n : NULL;
    for (int k = 0; k < n && low; k++) {
        mean[k] = unit * a->mean[curve][k];
        low[k] = unit * fmax(a->mean[curve][k] - a->interval[curve][k], 0.0);
        high[k] = unit * fmin(a->mean[curve][k] + a->interval[curve][k], highest);
    }
    riddle_plot_line(figure, label, a->time, mean, mean ? n : 0);
    riddle_plot_style(figure, 0, colour);
    if (low && seeds > 1) riddle_plot_band(figure, NULL, a->time, low, high, n), riddle_plot_style(figure, 0, colour);
    free(low);
}

static void draw(const study *st, const averages *a) {
    const settings *s = &st->variants[0].set;
    char what[100], title[140];
    snprintf(title, sizeof title, "%s, %d seed%s", describe(what, sizeof what, s), st->seeds, st->seeds > 1 ? "s" : "");
    riddle_plot *figure = riddle_plot_new(title, 1, 1);
    if (s->scene == SCENE_CLOSED_PLATE) {
        riddle_plot_panel(figure, 0, 0, "time [s]", "deviation of the mean heights h* [mm]");
        plot_average(figure, NULL, a, H_STAR, st->samples, st->seeds, 0, 1.0);
        riddle_plot_write(figure, st->self->out, "h_star.svg");
        return;
    }
    riddle_plot_panel(figure, 0, 0, "time [s]", "fraction retained [-]");
    riddle_plot_range_y(figure, 0.0, 1.02);
    for (int c = 0; c < UNDERSIZE; c++) plot_average(figure, class_name[c], a, c, st->samples, st->seeds, c, 1.0);
    if (s->case_number == 5 && s->scene == SCENE_SCREEN) { /* numbers in the text of section 5.1 */
        const double at[] = {5.0, 10.0}, small[] = {0.13, 0.015}, near_mesh[] = {0.20, 0.10};
        const int n = s->time >= 10.0 ? 2 : s->time >= 5.0 ? 1 : 0;
        if (n) riddle_plot_points(figure, "paper, small", at, small, n), riddle_plot_style(figure, 0, 0);
        if (n) riddle_plot_points(figure, "paper, near-mesh", at, near_mesh, n), riddle_plot_style(figure, 0, 1);
    }
    riddle_plot_write(figure, st->self->out, "retained.svg");
    double sitting = 0.0, least = 1.0;
    for (int k = 0; k < st->samples; k++)
        sitting = fmax(sitting, a->mean[OCCUPIED][k]), least = fmin(least, a->mean[FREE][k]);
    if (sitting < 0.02 && least > 0.98) {
        figure_left_out(st->self->out, "apertures.svg", "fewer than one aperture in fifty is taken at any time");
        return;
    }
    figure = riddle_plot_new("Apertures of the screen", 1, 1);
    riddle_plot_panel(figure, 0, 0, "time [s]", "share of apertures [-]");
    riddle_plot_range_y(figure, 0.0, 1.02);
    riddle_plot_line(figure, "free (none wedged)", a->time, a->mean[FREE], st->samples);
    riddle_plot_line(figure, "a particle sits in it", a->time, a->mean[OCCUPIED], st->samples);
    riddle_plot_write(figure, st->self->out, "apertures.svg");
}

static void write_averages(const study *st, const averages *a, const char *name) {
    riddle_io_file *curves =
        csv_open(st->self->out, name,
                 "time_s,retained_small,retained_small_sd,retained_near_mesh,retained_near_mesh_sd,free_fraction,"
                 "occupied_fraction,h_star_m,h_star_sd_m");
    for (int k = 0; k < st->samples; k++) {
        const double row[] = {a->time[k],          a->mean[SMALL][k], a->sd[SMALL][k],      a->mean[NEAR_MESH][k],
                              a->sd[NEAR_MESH][k], a->mean[FREE][k],  a->mean[OCCUPIED][k], a->mean[H_STAR][k],
                              a->sd[H_STAR][k]};
        riddle_io_row(curves, row, 9);
    }
    riddle_io_close(curves);
}

/* What the seeds of a variant give together. */
static void json_numbers(json *j, const study *st, int v) {
    for (int k = 0; k < NUMBERS; k++) {
        if (number_join[k] == ALONE || (number_join[k] >= WET_LARGEST && !(st->variants[v].set.moisture > 0.0)))
            continue;
        double sum = 0.0, mean = 0.0, most = result_of(st, v, 0)->number[k]; /* NaN stays */
        if (number_join[k] == WET_EACH) json_array_begin(j, number_name[k]);
        for (int q = 0; q < st->seeds; q++) {
            const double x = result_of(st, v, q)->number[k];
            sum += x, mean += x / st->seeds, most = x > most ? x : most;
            if (number_join[k] == WET_EACH) json_number(j, NULL, x);
        }
        if (number_join[k] == WET_EACH) json_array_end(j);
        else json_number(j, number_name[k], number_join[k] == SUM ? sum : number_join[k] == WET_MEAN ? mean : most);
    }
}

/* Settings and averages of a variant, as members of the object that is open. */
static void json_variant(json *j, const study *st, int v, const averages *a) {
    static const char *const scene[] = {"screen", "closed-plate", "thin-layer"};
    const settings *s = &st->variants[v].set;
    const result *first = result_of(st, v, 0);
    json_string(j, "scene", scene[s->scene]);
    results_values(j, {"case", s->case_number}, {"amplitude_m", s->amplitude}, {"frequency_hz", s->frequency},
                   {"moisture", s->moisture});
    json_string(j, "laws", s->moisture > 0.0 ? s->laws ? "printed" : "corrected" : NULL);
    json_number(j, "screen_diameter_m", s->screen_diameter);
    json_number(j, "drop_height_m", s->drop);
    json_string(j, "outlet", s->outlet ? "wall" : "delay");
    json_number(j, "outlet_delay_s", s->outlet_delay);
    json_string(j, "side_wall", s->walls ? "pvc" : "steel");
    json_number(j, "dt_s", first->number[TIME_STEP]);
    json_integer(j, "seeds", st->seeds);
    json_array(j, "time_s", a->time, st->samples);
    if (s->scene == SCENE_CLOSED_PLATE) {
        json_array(j, "h_star_m", a->mean[H_STAR], st->samples);
        if (st->seeds > 1) json_array(j, "h_star_sd_m", a->sd[H_STAR], st->samples);
    } else {
        json_array(j, "retained_small", a->mean[SMALL], st->samples);
        json_array(j, "retained_near_mesh", a->mean[NEAR_MESH], st->samples);
        if (st->seeds > 1) {
            json_array(j, "retained_small_sd", a->sd[SMALL], st->samples);
            json_array(j, "retained_near_mesh_sd", a->sd[NEAR_MESH], st->samples);
        }
        json_number(j, "top_layer_time_small_s", measure_of(st, v, top_layer(SMALL)).mean);
        json_number(j, "top_layer_time_near_mesh_s", measure_of(st, v, top_layer(NEAR_MESH)).mean);
        json_array(j, "free_fraction", a->mean[FREE], st->samples);
        json_array(j, "occupied_fraction", a->mean[OCCUPIED], st->samples);
    }
    json_numbers(j, st, v);
}

static void report_one(const study *st, double wall) {
    const settings *s = &st->variants[0].set;
    averages a;
    if (average(st, 0, &a)) return;
    const bool plate = s->scene == SCENE_CLOSED_PLATE, several = st->seeds > 1;
    riddle_io_table rows =
        riddle_io_table_begin(plate     ? "time [s]|h* [mm]|+- 95 %"
                              : several ? "time [s]|small retained|+- 95 %|near-mesh retained|+- 95 %|apertures free"
                                        : "time [s]|small retained|near-mesh retained|apertures free");
    for (int k = 0; k < st->samples;
         k += (int)(fmax(0.1, s->time >= 10.0 ? floor(s->time / 10.0 + 0.5) : s->time / 10.0) / SAMPLE + 0.5)) {
        riddle_io_table_cell(&rows, "%.1f", a.time[k]);
        if (plate)
            riddle_io_table_cell(&rows, "%.2f", 1e3 * a.mean[H_STAR][k]),
                interval_cell(&rows, 2, 1e3 * a.interval[H_STAR][k]);
        for (int c = 0; c < UNDERSIZE && !plate; c++) {
            riddle_io_table_cell(&rows, "%.3f", a.mean[c][k]);
            if (several) interval_cell(&rows, 3, a.interval[c][k]);
        }
        if (!plate) riddle_io_table_cell(&rows, "%.3f", a.mean[FREE][k]);
    }
    table_end(&rows);
    const result *r = result_of(st, 0, 0);
    if (!plate)
        common_print("mean time in the top layer: small %.2f s, near-mesh %.2f s\n",
                     measure_of(st, 0, top_layer(SMALL)).mean, measure_of(st, 0, top_layer(NEAR_MESH)).mean);
    common_print("%.3g steps of %.3g us, %.3g particle-steps, %.3g contact-steps a seed; %.1f s in all\n",
                 r->number[STEPS], 1e6 * r->number[TIME_STEP], r->number[PARTICLE_STEPS], r->number[CONTACT_STEPS],
                 wall);
    if (s->moisture > 0.0)
        common_print("liquid conserved to %.1e; %.0f bridges on average, %.0f ruptures (first seed)\n",
                     r->number[LIQUID_ERROR], r->number[BRIDGES], r->number[RUPTURES]);
    if (!isnan(r->number[ENERGY_ERROR]))
        common_print("energy ledger closes to %.1e of work, released potential and initial energy\n",
                     r->number[ENERGY_ERROR]);
    draw(st, &a);
    write_averages(st, &a, plate ? "h_star.csv" : "retained.csv");
    json *j = json_open(st->self->json);
    json_program(j, st->self);
    json_variant(j, st, 0, &a);
    json_bool(j, "deterministic_build", dem_build_is_deterministic());
    char hash[20];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)r->hash);
    json_string(j, "hash_first_seed", hash);
    json_close(j);
    free(a.time);
}

/* ---- the 27 cases ---- */

/* The files of a case all of whose seeds are done. */
static void write_case(const study *st, int v) {
    char name[NAME + 8], path[4096];
    averages a;
    if (average(st, v, &a)) return;
    snprintf(name, sizeof name, "%s.csv", st->variants[v].name);
    write_averages(st, &a, name);
    snprintf(name, sizeof name, "%s.json", st->variants[v].name);
    json *j = json_open(riddle_io_path(path, sizeof path, st->self->out, name));
    json_program(j, st->self);
    json_variant(j, st, v, &a);
    json_close(j);
    free(a.time);
}

/* All curves, as examples/screen_fit reads them. */
static void write_curves(const study *st) {
    const int every = (int)(CURVE_STEP / SAMPLE + 0.5);
    riddle_io_file *file =
        csv_open(st->self->out, "curves.csv",
                 "case,amplitude_m,frequency_hz,moisture,seed,time_s,retained_small,retained_near_mesh");
    for (int v = 0; v < st->variant_count; v++) {
        const settings *s = &st->variants[v].set;
        for (int q = 0; q < st->seeds; q++) {
            const result *r = result_of(st, v, q);
            for (int k = 0; k < r->samples; k += every)
                csv_line(file, "%d,%g,%g,%g,%d,%g,%.6f,%.6f", s->case_number, s->amplitude, s->frequency, s->moisture,
                         q + 1, k * SAMPLE, r->curve[SMALL][k], r->curve[NEAR_MESH][k]);
        }
    }
    riddle_io_close(file);
}

/* A panel for each amplitude and frequency, in it a curve for each moisture. */
static void draw_cases(const study *st) {
    riddle_plot *figure = riddle_plot_new("Fraction retained, 27 cases: 5 mm full, 7 mm dashed", 3, 3);
    riddle_plot_panel_size(figure, 330, 230);
    for (int i = 0; i < 9; i++) {
        char title[60];
        riddle_plot_panel(figure, i / 3, i % 3, "time [s]", "fraction retained [-]");
        snprintf(title, sizeof title, "%.1f mm, %.1f Hz", 1e3 * case_amplitude[i / 3], case_frequency[i % 3]);
        riddle_plot_title(figure, title);
        riddle_plot_range_y(figure, 0.0, 1.02);
        for (int m = 0; m < 3; m++) {
            averages a;
            if (average(st, 9 * m + i, &a)) continue;
            char label[20];
            snprintf(label, sizeof label, m ? "%.3g %% water" : "dry", 100.0 * case_moisture[m]);
            riddle_plot_line(figure, label, a.time, a.mean[SMALL], st->samples), riddle_plot_style(figure, 0, m);
            riddle_plot_line(figure, NULL, a.time, a.mean[NEAR_MESH], st->samples),
                riddle_plot_style(figure, RIDDLE_PLOT_DASHED, m);
            free(a.time);
        }
    }
    riddle_plot_write(figure, st->self->out, "cases.svg");
}

/* Counterpart of the paper's figure 5: the mean time in the top layer of both classes in all cases; 95 % of the mean
   where there are several seeds. */
static void report_top_layer(const study *st) {
    riddle_plot *figure = riddle_plot_new("Mean time in the top layer, 27 cases", 1, UNDERSIZE);
    result_table *t =
        results_of("case,amplitude_m,frequency_hz,moisture,seeds,small_s,small_ci_s,near_mesh_s,near_mesh_ci_s");
    for (int v = 0; v < CASES; v++) {
        const settings *s = &st->variants[v].set;
        const statistics small = measure_of(st, v, top_layer(SMALL)),
                         near_mesh = measure_of(st, v, top_layer(NEAR_MESH));
        results_row(t, NULL, s->case_number, s->amplitude, s->frequency, s->moisture, st->seeds, small.mean,
                    small.interval, near_mesh.mean, near_mesh.interval);
    }
    results_csv(t, st->self->out, "top_layer.csv");
    results_free(t);
    for (int c = 0; c < UNDERSIZE; c++) {
        riddle_plot_panel_size(figure, 420, 300);
        riddle_plot_panel(figure, 0, c, "amplitude times frequency [m/s]", "time in the top layer [s]");
        riddle_plot_title(figure, class_name[c]);
        double longest = 0.0;
        for (int m = 0; m < 3; m++) {
            double speed[9], time[9];
            char label[20];
            for (int i = 0; i < 9; i++) {
                const settings *s = &st->variants[9 * m + i].set;
                speed[i] = s->amplitude * s->frequency;
                time[i] = measure_of(st, 9 * m + i, top_layer(c)).mean;
                longest = fmax(longest, time[i]);
            }
            snprintf(label, sizeof label, m ? "%.3g %% water" : "dry", 100.0 * case_moisture[m]);
            riddle_plot_points(figure, label, speed, time, 9), riddle_plot_style(figure, 0, m);
        }
        const double initial = st->variants[4].set.amplitude * st->variants[4].set.frequency,
                     paper = c == SMALL ? 2.05 : 3.62;
        riddle_plot_points(figure, "text of the paper, dry", &initial, &paper, 1), riddle_plot_style(figure, 0, 3);
        riddle_plot_range_y(figure, 0.0, 1.1 * fmax(longest, paper));
    }
    riddle_plot_write(figure, st->self->out, "top_layer.svg");
}

static void json_statistics(json *j, const char *key, statistics s) {
    json_object_begin(j, key);
    results_values(j, {"mean", s.mean}, {"sd", s.sd}, {"interval_95", s.interval});
    json_object_end(j);
}

static void summary(const study *st, json *j) {
    static const double when[] = {5.0, 10.0, 20.0};
    json_program(j, st->self);
    json_integer(j, "seeds", st->seeds);
    json_array_begin(j, "cases");
    for (int v = 0; v < st->variant_count; v++) {
        const settings *s = &st->variants[v].set;
        json_object_begin(j, NULL);
        results_values(j, {"case", s->case_number}, {"amplitude_m", s->amplitude}, {"frequency_hz", s->frequency},
                       {"moisture", s->moisture});
        for (int k = 0; k < 3; k++) {
            const int sample = (int)(when[k] / SAMPLE + 0.5);
            char key[40];
            for (int c = 0; c < UNDERSIZE && sample < st->samples; c++) {
                snprintf(key, sizeof key, "%s_%.0f_s", curve_name[c], when[k]);
                json_statistics(j, key, measure_of(st, v, at_time(c, when[k])));
            }
        }
        json_number(j, "deviation_from_model_2", deviation_from_model(st, v));
        json_statistics(j, "top_layer_time_small_s", measure_of(st, v, top_layer(SMALL)));
        json_statistics(j, "top_layer_time_near_mesh_s", measure_of(st, v, top_layer(NEAR_MESH)));
        json_object_end(j);
    }
    json_array_end(j);
}

static void report_cases(const study *st) {
    const int end = st->samples - 1, five = (int)(5.0 / SAMPLE + 0.5) < end ? (int)(5.0 / SAMPLE + 0.5) : end;
    riddle_io_table t = riddle_io_table_begin(
        "case|mm|Hz|water %|time [s]|small|+- 95 %|near-mesh|+- 95 %|at the end: small|+- 95 %|near-mesh|+- 95 %");
    for (int v = 0; v < st->variant_count; v++) {
        const settings *s = &st->variants[v].set;
        riddle_io_table_cell(&t, "%d", s->case_number), riddle_io_table_cell(&t, "%.1f", 1e3 * s->amplitude),
            riddle_io_table_cell(&t, "%.1f", s->frequency);
        riddle_io_table_cell(&t, "%.1f", 100.0 * s->moisture), riddle_io_table_cell(&t, "%.1f", five * SAMPLE);
        for (int k = 0; k < 2; k++)
            for (int c = 0; c < UNDERSIZE; c++) {
                const statistics x = measure_of(st, v, at_time(c, SAMPLE * (k ? end : five)));
                riddle_io_table_cell(&t, "%.3f", x.mean), interval_cell(&t, 3, x.interval);
            }
    }
    table_end(&t);
    write_curves(st);
    draw_cases(st);
    report_top_layer(st);
    static findings f;
    find_cases(&f, st);
    char path[4096];
    const char *const files[2] = {riddle_io_path(path, sizeof path, st->self->out, "summary.json"), st->self->json};
    for (int k = 0; k < 2; k++) {
        json *j = json_open(files[k]);
        summary(st, j);
        json_findings(j, &f);
        json_close(j);
    }
    report_findings(&f, st->seeds < 2, st->self->out);
}

/* ---- sensitivity: what the paper leaves open, one thing at a time ---- */

static void add_sensitivity(study *st, const settings *base) {
    settings s;
    add_variant(st, base, "default");
    s = *base, s.screen_diameter = 0.185, add_variant(st, &s, "deck 185 mm");
    s = *base, s.screen_diameter = 0.195, add_variant(st, &s, "deck 195 mm");
    s = *base, s.screen_diameter = 0.200, add_variant(st, &s, "deck 200 mm");
    s = *base, s.drop = 0.010, add_variant(st, &s, "drop 10 mm");
    s = *base, s.drop = 0.060, add_variant(st, &s, "drop 60 mm");
    s = *base, s.outlet_delay = 0.25, add_variant(st, &s, "outlet 0.25 s");
    s = *base, s.outlet_delay = 1.0, add_variant(st, &s, "outlet 1.0 s");
    s = *base, s.profile = 1, add_variant(st, &s, "round bars");
    s = *base, s.sideways = 0.0, add_variant(st, &s, "no sideways");
    s = *base, s.vertical = 1.0, add_variant(st, &s, "vertical 1.0 A");
    s = *base, s.restitution = 1, add_variant(st, &s, "naive damping");
    s = *base, s.dt_ratio *= 2.0, add_variant(st, &s, "half step");
}

static void report_sensitivity(const study *st) {
    const double when[2] = {5.0, 10.0}, paper[2][UNDERSIZE] = {{0.13, 0.20}, {0.015, 0.10}};
    const char *const heading[2] = {"after 5 s", "after 10 s"}, *names[VARIANTS_MAX + 1] = {"paper"};
    riddle_plot *figure = riddle_plot_new("What the paper leaves open, one at a time: dry initial case", 2, 1);
    static const result_column columns[] = {{"variant", "variant", "%s"},
                                            {"time_s", "time [s]", "%.0f"},
                                            {"small", "small", "%.3f"},
                                            {"small_sd", "sd", "%.3f"},
                                            {"near_mesh", "near-mesh", "%.3f"},
                                            {"near_mesh_sd", "sd", "%.3f"},
                                            {"seeds"}};
    result_table *t = RESULTS(columns);
    for (int v = 0; v < st->variant_count; v++) names[v + 1] = st->variants[v].name;
    for (int w = 0; w < 2; w++) {
        double mean[UNDERSIZE][VARIANTS_MAX + 1] = {{paper[w][SMALL]}, {paper[w][NEAR_MESH]}};
        for (int v = 0; v < st->variant_count; v++) {
            statistics s[UNDERSIZE];
            for (int c = 0; c < UNDERSIZE; c++) {
                s[c] = measure_of(st, v, at_time(c, when[w]));
                mean[c][v + 1] = s[c].mean;
            }
            results_row(t, TEXTS(names[v + 1]), when[w], s[SMALL].mean, s[SMALL].sd, s[NEAR_MESH].mean, s[NEAR_MESH].sd,
                        st->seeds);
        }
        riddle_plot_panel(figure, w, 0, "", "fraction retained [-]");
        riddle_plot_title(figure, heading[w]);
        for (int c = 0; c < UNDERSIZE; c++)
            riddle_plot_bars(figure, class_name[c], names, mean[c], st->variant_count + 1);
        riddle_plot_horizontal(figure, "", paper[w][SMALL]);
        riddle_plot_horizontal(figure, "", paper[w][NEAR_MESH]);
    }
    riddle_plot_panel_size(figure, 980, 300);
    results_print(t);
    results_csv(t, st->self->out, "sensitivity.csv");
    results_free(t);
    riddle_plot_write(figure, st->self->out, "sensitivity.svg");
    json *j = json_open(st->self->json);
    json_program(j, st->self);
    json_close(j);
}

/* ---- a case and its neighbours: one of amplitude, frequency and moisture changed at a time ---- */

enum { FACTORS = 3, LEVELS = 3 };
static const char *const factor_name[FACTORS] = {"amplitude [mm]", "frequency [Hz]", "water [%]"};

static double level(const settings *s, int factor) {
    return factor == 0 ? 1e3 * s->amplitude : factor == 1 ? s->frequency : 100.0 * s->moisture;
}

static void add_neighbours(study *st, const settings *base) {
    static const char *const symbol[FACTORS] = {"A", "f", "M"};
    char name[NAME];
    add_variant(st, base, "base");
    for (int factor = 0; factor < FACTORS; factor++)
        for (int k = 0; k < LEVELS; k++) {
            settings s = *base;
            if (factor == 0) s.amplitude = case_amplitude[k];
            else if (factor == 1) s.frequency = case_frequency[k];
            else s.moisture = case_moisture[k];
            if (level(&s, factor) == level(base, factor)) continue;
            s.case_number = 0;
            for (int number = 1; number <= CASES && !s.case_number; number++) {
                settings c;
                choose_case(&c, number);
                if (c.amplitude == s.amplitude && c.frequency == s.frequency && c.moisture == s.moisture)
                    s.case_number = number;
            }
            snprintf(name, sizeof name, "%s %g", symbol[factor], level(&s, factor));
            add_variant(st, &s, name);
        }
}

/* The variants in which only one factor differs from the first, the first included, by its level. Returns how many. */
static int along(const study *st, int factor, int *order) {
    int n = 0;
    for (int v = 0; v < st->variant_count; v++) {
        bool others_same = true;
        for (int other = 0; other < FACTORS; other++)
            if (other != factor && level(&st->variants[v].set, other) != level(&st->variants[0].set, other))
                others_same = false;
        if (!others_same) continue;
        int at = n++;
        for (; at > 0 && level(&st->variants[order[at - 1]].set, factor) > level(&st->variants[v].set, factor); at--)
            order[at] = order[at - 1];
        order[at] = v;
    }
    return n;
}

/* How h* of a variant differs from that of the first one with the same mixtures, and how early it rises. */
static void json_rise(json *j, const study *st, int v) {
    const contrast beyond = contrast_of(st, 0, v, over_time(H_STAR, 0.0, st->variants[0].set.time));
    double share[SEEDS_MAX] = {0.0};
    for (int q = 0; q < st->seeds; q++) share[q] = risen_early(st, v, q);
    json_number(j, "h_star_beyond_first", beyond.difference);
    json_number(j, "h_star_beyond_first_interval_95", beyond.paired);
    json_statistics(j, "risen_early", statistics_of(st->seeds, share));
}

static void report_neighbours(const study *st) {
    const settings *base = &st->variants[0].set;
    const bool plate = base->scene == SCENE_CLOSED_PLATE;
    const int curves[2] = {plate ? H_STAR : SMALL, NEAR_MESH}, rows = plate ? 1 : 2;
    const char *const what[2] = {plate ? "h*, deviation of the mean heights [mm]" : "small retained [-]",
                                 "near-mesh retained [-]"};
    char title[120], text[100];
    snprintf(title, sizeof title, "%s: %s and neighbours, %d seed%s",
             plate                             ? "Closed plate"
             : base->scene == SCENE_THIN_LAYER ? "Thin layer"
                                               : "Screen",
             describe(text, sizeof text, base), st->seeds, st->seeds > 1 ? "s" : "");
    riddle_plot *figure = riddle_plot_new(title, rows, FACTORS);
    riddle_io_table t = riddle_io_table_begin(plate ? "factor|level|mean h* [mm]|+- 95 %|last fifth [mm]|+- 95 %"
                                                    : "factor|level|small, mean over time|+- 95 %|near-mesh, mean over "
                                                      "time|+- 95 %|small, at the end|near-mesh, at the end");
    riddle_io_file *file =
        csv_open(st->self->out, "neighbours.csv",
                 "variant,amplitude_m,frequency_hz,moisture,seed,time_s,retained_small,retained_near_mesh,h_star_m");
    json *j = json_open(st->self->json);
    json_program(j, st->self);
    json_array_begin(j, "trends");
    static findings f;
    f.count = 0;
    for (int factor = 0; factor < FACTORS; factor++) {
        int order[VARIANTS_MAX];
        const int n = along(st, factor, order);
        find_neighbours(&f, st, factor, n, order);
        for (int row = 0; row < rows; row++) {
            riddle_plot_panel(figure, row, factor, "time [s]", what[row]);
            if (!plate) riddle_plot_range_y(figure, 0.0, 1.02);
            riddle_plot_title(figure, factor_name[factor]);
            for (int k = 0; k < n; k++) {
                averages a;
                if (average(st, order[k], &a)) continue;
                char label[20];
                snprintf(label, sizeof label, "%g", level(&st->variants[order[k]].set, factor));
                plot_average(figure, label, &a, curves[row], st->samples, st->seeds, k, plate ? HUGE_VAL : 1.0);
                free(a.time);
            }
        }
        for (int k = 0; k < n; k++) {
            const int v = order[k];
            riddle_io_table_cell(&t, "%s", factor_name[factor]),
                riddle_io_table_cell(&t, "%g", level(&st->variants[v].set, factor));
            json_object_begin(j, NULL);
            json_string(j, "factor", factor_name[factor]);
            json_number(j, "level", level(&st->variants[v].set, factor));
            for (int row = 0; row < rows; row++) {
                const statistics mean = measure_of(st, v, over_time(curves[row], 0.0, base->time)),
                                 end = measure_of(st, v,
                                                  plate ? over_time(H_STAR, 0.8 * base->time, base->time)
                                                        : at_time(curves[row], base->time));
                const double unit = plate ? 1e3 : 1.0;
                const int digits = plate ? 2 : 3;
                interval_cell(&t, digits, unit * mean.mean), interval_cell(&t, digits, unit * mean.interval);
                if (plate) interval_cell(&t, digits, unit * end.mean), interval_cell(&t, digits, unit * end.interval);
                snprintf(text, sizeof text, "%s_mean_over_time", curve_name[curves[row]]);
                json_statistics(j, text, mean);
                snprintf(text, sizeof text, plate ? "%s_last_fifth" : "%s_end", curve_name[curves[row]]);
                json_statistics(j, text, end);
            }
            if (plate) json_rise(j, st, v);
            for (int c = 0; c < UNDERSIZE && !plate; c++)
                riddle_io_table_cell(&t, "%.3f", measure_of(st, v, at_time(c, base->time)).mean);
            json_object_end(j);
        }
    }
    json_array_end(j);
    json_array_begin(j, "variants");
    for (int v = 0; v < st->variant_count; v++) {
        const settings *s = &st->variants[v].set;
        averages a;
        if (average(st, v, &a)) continue;
        json_object_begin(j, NULL);
        json_variant(j, st, v, &a);
        json_object_end(j);
        free(a.time);
        for (int q = 0; q < st->seeds; q++)
            for (int k = 0; k < st->samples; k++) {
                const result *r = result_of(st, v, q);
                csv_line(file, "%s,%g,%g,%g,%d,%g,%.6f,%.6f,%.6g", st->variants[v].name, s->amplitude, s->frequency,
                         s->moisture, q + 1, k * SAMPLE, r->curve[SMALL][k], r->curve[NEAR_MESH][k],
                         r->curve[H_STAR][k]);
            }
    }
    json_array_end(j);
    json_findings(j, &f);
    json_close(j);
    riddle_io_close(file);
    table_end(&t);
    report_findings(&f, st->seeds < 2, st->self->out);
    riddle_plot_write(figure, st->self->out, "neighbours.svg");
}

/* ---- what moisture changes: differences of means, for the corrected and the printed laws ---- */

static void add_moistures(study *st, const settings *base) {
    settings s = *base;
    s.moisture = 0.0, s.laws = 0, s.case_number = 0;
    add_variant(st, &s, "dry");
    for (s.laws = 0; s.laws < 2; s.laws++)
        for (int m = 1; m < 3; m++) {
            char name[NAME];
            s.moisture = case_moisture[m];
            snprintf(name, sizeof name, "%.1f %s", 100.0 * s.moisture, s.laws ? "printed" : "corrected");
            add_variant(st, &s, name);
        }
}

/* The difference of the same mixtures in each second. */
static void json_course(json *j, const study *st, int from, int to, int curve) {
    enum { MOST = 100 };
    double difference[MOST], interval[MOST];
    int n = 0;
    for (; n < MOST && n + 1 <= st->variants[0].set.time + 1e-9; n++) {
        const contrast x = contrast_of(st, from, to, at_time(curve, n + 1));
        difference[n] = x.difference, interval[n] = x.paired;
    }
    json_array(j, "difference_each_second", difference, n);
    json_array(j, "interval_95_paired_each_second", interval, n);
}

/* Curves of the dry and the wet batch: a row for each class, a column for each moisture. */
static void draw_laws(const study *st) {
    static const char *const labels[3] = {"dry", "corrected laws", "printed laws"};
    const settings *dry = &st->variants[0].set;
    char title[120];
    snprintf(title, sizeof title, "Laws of liquid bridges, corrected and as printed: %.3g mm, %.3g Hz, %d seed%s",
             1e3 * dry->amplitude, dry->frequency, st->seeds, st->seeds > 1 ? "s" : "");
    riddle_plot *figure = riddle_plot_new(title, UNDERSIZE, 2);
    for (int c = 0; c < UNDERSIZE; c++)
        for (int m = 0; m < 2; m++) {
            riddle_plot_panel(figure, c, m, "time [s]", "fraction retained [-]");
            riddle_plot_range_y(figure, 0.0, 1.02);
            snprintf(title, sizeof title, "%s, %.1f %% water", class_name[c], 100.0 * case_moisture[1 + m]);
            riddle_plot_title(figure, title);
            for (int k = 0; k < 3; k++) {
                averages a;
                if (average(st, k ? 2 * k - 1 + m : 0, &a)) continue;
                plot_average(figure, labels[k], &a, c, st->samples, st->seeds, k, 1.0);
                free(a.time);
            }
        }
    riddle_plot_write(figure, st->self->out, "laws.svg");
}

static void report_moisture(const study *st) {
    enum { DIFFERENCES = 8 }; /* by moisture for each of the laws, and between the laws */
    static const int from[DIFFERENCES] = {0, 0, 1, 0, 0, 3, 1, 2}, to[DIFFERENCES] = {1, 2, 2, 3, 4, 4, 3, 4};
    const double end = (st->samples - 1) * SAMPLE;
    const settings *dry = &st->variants[0].set;
    char title[120];
    snprintf(title, sizeof title, "Retained after %g s, wet minus dry: %.3g mm, %.3g Hz, %d seeds, 95 %% intervals",
             end, 1e3 * dry->amplitude, dry->frequency, st->seeds);
    riddle_plot *figure = riddle_plot_new(title, 1, 2);
    riddle_io_table t =
        riddle_io_table_begin("class|laws|from %|to %|difference|+- paired|+- independent|correlation of pairs");
    json *j = json_open(st->self->json);
    json_program(j, st->self);
    results_values(j, {"amplitude_m", dry->amplitude}, {"frequency_hz", dry->frequency}, {"time_s", end});
    json_integer(j, "seeds", st->seeds);
    riddle_io_table means = riddle_io_table_begin("batch|small|sd|+- 95 %|near-mesh|sd|+- 95 %");
    json_array_begin(j, "means");
    for (int v = 0; v < st->variant_count; v++) {
        riddle_io_table_cell(&means, "%s", st->variants[v].name);
        for (int c = 0; c < UNDERSIZE; c++) {
            const statistics x = measure_of(st, v, at_time(c, end));
            riddle_io_table_cell(&means, "%.3f", x.mean), interval_cell(&means, 3, x.sd),
                interval_cell(&means, 3, x.interval);
        }
        json_object_begin(j, NULL);
        json_number(j, "moisture", st->variants[v].set.moisture);
        json_string(j, "laws", v == 0 ? NULL : st->variants[v].set.laws ? "printed" : "corrected");
        for (int c = 0; c < UNDERSIZE; c++) json_statistics(j, curve_name[c], measure_of(st, v, at_time(c, end)));
        json_object_end(j);
    }
    json_array_end(j);
    table_end(&means);
    json_array_begin(j, "differences");
    for (int c = 0; c < UNDERSIZE; c++) {
        for (int k = 0; k < DIFFERENCES; k++) {
            const contrast x = contrast_of(st, from[k], to[k], at_time(c, end));
            const double low = st->variants[from[k]].set.moisture, high = st->variants[to[k]].set.moisture;
            const char *laws = low == high                    ? "printed minus corrected"
                               : st->variants[to[k]].set.laws ? "printed"
                                                              : "corrected";
            riddle_io_table_cell(&t, "%s", class_name[c]), riddle_io_table_cell(&t, "%s", laws);
            riddle_io_table_cell(&t, "%.1f", 100.0 * low), riddle_io_table_cell(&t, "%.1f", 100.0 * high),
                riddle_io_table_cell(&t, "%+.3f", x.difference);
            interval_cell(&t, 3, x.paired), interval_cell(&t, 3, x.independent), interval_cell(&t, 2, x.correlation);
            json_object_begin(j, NULL);
            json_string(j, "class", class_name[c]);
            json_string(j, "laws", laws);
            results_values(j, {"from_moisture", low}, {"to_moisture", high}, {"difference", x.difference},
                           {"interval_95_paired", x.paired}, {"interval_95_independent", x.independent},
                           {"correlation", x.correlation});
            json_course(j, st, from[k], to[k], c);
            json_object_end(j);
        }
        riddle_plot_panel(figure, 0, c, "water [%]", "difference of the fraction retained [-]");
        riddle_plot_title(figure, class_name[c]);
        riddle_plot_range_x(figure, 0.0, 6.0);
        riddle_plot_horizontal(figure, "dry", 0.0);
        for (int laws = 0; laws < 2; laws++) {
            double x[2], y[2], plus_minus[2];
            for (int m = 0; m < 2; m++) {
                const int v = 1 + 2 * laws + m;
                const contrast d = contrast_of(st, 0, v, at_time(c, end));
                x[m] = 100.0 * st->variants[v].set.moisture + (laws ? 0.08 : -0.08); /* beside each other */
                y[m] = d.difference, plus_minus[m] = d.paired;
            }
            const char *label = laws ? "printed laws" : "corrected laws";
            if (st->seeds > 1) riddle_plot_error_bars(figure, label, x, y, plus_minus, 2);
            else riddle_plot_points(figure, label, x, y, 2);
        }
    }
    json_array_end(j);
    json_close(j);
    table_end(&t);
    riddle_plot_write(figure, st->self->out, "moisture.svg");
    draw_laws(st);
}

/* ---- running a study ---- */

static int run_one(int index, void *user) {
    study *st = user;
    /* the last cases are the wet ones, which take longest: they begin first */
    const int k = st->kind == STUDY_CASES ? st->variant_count * st->seeds - 1 - index : index, v = k / st->seeds,
              q = k % st->seeds;
    result *r = result_of(st, v, q);
    if (!r->done) {
        const bool shown = v == 0 && q == 0 && st->kind == STUDY_ONE;
        const observer watcher = {st->bar, shown ? st->series : NULL, shown ? st->reel : NULL,
                                  shown ? st->self->out : NULL};
        run_scene(&st->variants[v].set, st->seed + (uint64_t)q, r, &watcher);
        if (r->done && st->runs) write_run(st, v, q);
    }
    pthread_mutex_lock(&st->lock);
    const bool last = r->done && --st->left[v] == 0;
    pthread_mutex_unlock(&st->lock);
    if (last && st->kind == STUDY_CASES) write_case(st, v);
    return !r->done;
}

static void run_study(study *st) {
    const int runs = st->variant_count * st->seeds;
    double work = 0.0;
    progress bar;
    for (int k = 0; k < runs; k++)
        if (!st->results[k].done) work += st->variants[k / st->seeds].set.time;
    for (int v = 0; v < st->variant_count; v++) st->left[v] = st->seeds;
    pthread_mutex_init(&st->lock, NULL);
    st->bar = &bar;
    progress_begin(&bar, "screening", work);
    jobs_run(runs, st->self->threads, run_one, st);
    progress_end(&bar);
    pthread_mutex_destroy(&st->lock);
    for (int k = 0; k < runs && !common_interrupted(); k++)
        if (st->results[k].status != DEM_OK)
            common_fail("%s, seed %d: %s (particle %llu)", st->variants[k / st->seeds].name, k % st->seeds + 1,
                        dem_status_text(st->results[k].status), (unsigned long long)st->results[k].failed_id);
}

static void report(const study *st, double wall) {
    if (st->kind == STUDY_ONE) report_one(st, wall);
    if (st->kind == STUDY_CASES) report_cases(st);
    if (st->kind == STUDY_VARY) report_neighbours(st);
    if (st->kind == STUDY_MOISTURE) report_moisture(st);
    if (st->kind == STUDY_SENSITIVITY) report_sensitivity(st);
}

/* ---- what was asked for ---- */

typedef struct wish {
    settings set;
    double amplitude_mm, frequency_hz, diameter_mm, drop_mm, moisture;
    int number, seeds; /* number: of the case */
    bool no_frames, film, no_energy, all_cases, vary, compare, sensitivity, resume;
} wish;

static wish default_wish(void) {
    wish w = {0};
    w.set.time = 20.0, w.set.dt_ratio = 8.0, w.set.mass = 1.41, w.set.outlet_delay = 0.5, w.set.exit_depth = 0.012;
    w.set.vertical = 0.9, w.set.sideways = 0.1;
    w.amplitude_mm = 1.0, w.frequency_hz = 50.6, w.diameter_mm = 190.0, w.drop_mm = 30.0;
    w.number = 5, w.seeds = 1;
    return w;
}

static study_kind kind_of(const wish *w) {
    return w->all_cases     ? STUDY_CASES
           : w->vary        ? STUDY_VARY
           : w->compare     ? STUDY_MOISTURE
           : w->sensitivity ? STUDY_SENSITIVITY
                            : STUDY_ONE;
}

/* Refuses what does not go together. */
static void check_wish(const program *self, const wish *w) {
    const bool motion = is_given(self, "amplitude-mm") || is_given(self, "frequency-hz"),
               of_screen = w->set.scene == SCENE_SCREEN;
    if (is_given(self, "case") && motion)
        program_refuse(self, "case", NULL, "not together with --amplitude-mm or --frequency-hz");
    if (w->all_cases + w->vary + w->compare + w->sensitivity > 1)
        program_refuse(self, "all-cases, --vary, --compare-moisture, --sensitivity", NULL, "only one of them");
    if (w->resume && kind_of(w) == STUDY_ONE) program_refuse(self, "resume", NULL, "only with a study of several runs");
    if (w->all_cases && (is_given(self, "case") || motion || is_given(self, "moisture")))
        program_refuse(self, "all-cases", NULL, "not together with a case, an amplitude, a frequency or a moisture");
    if (w->set.outlet && !of_screen) program_refuse(self, "outlet", "wall", "only with --scene screen");
    if (w->set.outlet && is_given(self, "outlet-delay"))
        program_refuse(self, "outlet", "wall", "not together with --outlet-delay");
    if (!of_screen && (w->all_cases || w->compare || w->sensitivity))
        program_refuse(self, "scene", NULL, "this study is of the screen");
}

/* Completes the settings: options that were not given get the defaults of their scene and study. */
static void complete_settings(const program *self, wish *w) {
    const study_kind kind = kind_of(w);
    settings *s = &w->set;
    choose_case(s, w->number);
    if (is_given(self, "amplitude-mm") || is_given(self, "frequency-hz"))
        s->case_number = 0, s->amplitude = 1e-3 * w->amplitude_mm, s->frequency = w->frequency_hz;
    if (is_given(self, "moisture")) s->moisture = w->moisture, s->case_number = 0;
    if (s->scene != SCENE_SCREEN && !is_given(self, "drop-mm")) w->drop_mm = 0.0;
    if (s->scene == SCENE_CLOSED_PLATE && !is_given(self, "time")) s->time = 10.0;
    if ((s->scene == SCENE_THIN_LAYER || w->compare) && !is_given(self, "time")) s->time = 5.0;
    if (s->scene == SCENE_THIN_LAYER) { /* passage counts when a centre is below the mesh plane */
        if (!is_given(self, "outlet-delay")) s->outlet_delay = 0.0;
        s->exit_depth = 0.0;
        s->mass *= 0.25;
    }
    if (s->outlet) s->outlet_delay = 0.0;
    if (w->sensitivity) s->time = 10.0;
    if (self->quick && !is_given(self, "time") && !w->sensitivity)
        s->time = kind == STUDY_ONE ? 1.5 : 1.2; /* long enough that most small ones pass */
    if (self->quick) s->mass = fmin(s->mass, kind == STUDY_ONE ? 0.3 : 0.03);
    s->screen_diameter = 1e-3 * w->diameter_mm;
    s->drop = 1e-3 * w->drop_mm;
    s->energy = !w->no_energy && kind == STUDY_ONE;
}

/* Adds the variants of a study. */
static void plan(study *st, settings *s) {
    char name[NAME];
    switch (st->kind) {
    case STUDY_ONE: add_variant(st, s, "run"); break;
    case STUDY_CASES:
        for (int k = 1; k <= CASES; k++) {
            choose_case(s, k);
            snprintf(name, sizeof name, "case_%02d", k);
            add_variant(st, s, name);
        }
        break;
    case STUDY_VARY: add_neighbours(st, s); break;
    case STUDY_MOISTURE: add_moistures(st, s); break;
    case STUDY_SENSITIVITY: add_sensitivity(st, s); break;
    }
}

/* Makes the folder of single runs, and reads those that are done. */
static void open_runs(study *st, char *path, size_t size, bool resume) {
    char message[300];
    st->runs = riddle_io_path(path, size, st->self->out, "runs");
    if (riddle_io_make_folder(st->runs, message, sizeof message)) common_fail("%s: %s", st->runs, message);
    for (int k = 0; k < st->variant_count * st->seeds && resume; k++) read_run(st, k / st->seeds, k % st->seeds);
}

int main(int argc, char **argv) {
    static study st;
    wish w = default_wish();
    option options[] = {
        option_int("case", "N", &w.number, 1, CASES,
                   "case of table 5 of the paper: 1-9 dry, 10-18 with 2.5 %, 19-27 with 5 % of water"),
        option_double("amplitude-mm", "MM", &w.amplitude_mm, 0.0, 5.0, "set amplitude [mm], instead of a case"),
        option_double("frequency-hz", "HZ", &w.frequency_hz, 0.0, 200.0, "frequency [Hz], instead of a case"),
        option_double("moisture", "SHARE", &w.moisture, 0.0, 0.08,
                      "mass of water over mass of particles [-], instead of the case's"),
        option_positive("time", "S", &w.set.time, 1e4,
                        "simulated time [s]; default on a closed plate 10, thin layer and --compare-moisture 5"),
        option_double("drop-mm", "MM", &w.drop_mm, 0.0, 500.0,
                      "height of the bin's floor over the bars [mm]; default 0 without a bin"),
        option_double("outlet-delay", "S", &w.set.outlet_delay, 0.0, 10.0,
                      "time from the screen to the outlet's end [s]; thin layer 0"),
        option_double("mass", "KG", &w.set.mass, 0.005, 1000.0,
                      "mass of the batch [kg]; thin layer: a quarter of it is used"),
        option_choice("scene", &w.set.scene, "screen|closed-plate|thin-layer",
                      "batch on the screen, on a plate without apertures, or a quarter"),
        option_choice("laws", &w.set.laws, "corrected|printed",
                      "liquid bridges by Young-Laplace, or by eqs 12-18 as printed"),
        option_int("seeds", "N", &w.seeds, 1, SEEDS_MAX, "independent mixtures, one per core; mean and interval"),
        option_double("screen-diameter-mm", "MM", &w.diameter_mm, 50.0, 2000.0, "clear diameter of the deck [mm]"),
        option_double("sideways", "SHARE", &w.set.sideways, 0.0, 1.0, "horizontal over set amplitude [-]"),
        option_double("vertical", "SHARE", &w.set.vertical, 0.0, 2.0, "vertical over set amplitude [-]"),
        option_choice("profile", &w.set.profile, "semicircle|round", "section of the bars"),
        option_choice("side-wall", &w.set.walls, "steel|pvc",
                      "material of the side wall: PVC has another contact angle, of water"),
        option_choice("outlet", &w.set.outlet, "delay|wall",
                      "passage counts after a delay, or at the end of an inclined wall"),
        option_choice("restitution", &w.set.restitution, "clipped|naive",
                      "how damping follows from the coefficient of restitution"),
        option_double("steps-per-contact", "N", &w.set.dt_ratio, 8.0, 1000.0,
                      "duration of the shortest contact over the time step [-]"),
        option_flag("no-frames", &w.no_frames, "no .vtp series"),
        option_flag("movie", &w.film, "batch_screening.mp4, half as fast as it is, by ffmpeg"),
        option_size("size", screen_view.size, "of the picture and the movie [pixels]"),
        option_flag("no-energy", &w.no_energy, "no energy ledger"),
        option_flag("all-cases", &w.all_cases,
                    "the 27 cases, --seeds runs each: a file a case, all curves, summary.json"),
        option_flag("vary", &w.vary,
                    "the case and its neighbours in table 3: amplitude, frequency, moisture, one at a time"),
        option_flag("compare-moisture", &w.compare, "what 2.5 and 5 % of water change, corrected and printed laws"),
        option_flag("sensitivity", &w.sensitivity, "vary what the paper leaves open, one thing at a time; 10 s"),
        option_flag("resume", &w.resume,
                    "with one of these studies: runs whose files are in the folder are not run again"),
    };
    program self = program_start("batch_screening",
                                 "Glass spheres of 5, 7 and 10 mm on a vibrated sieve with 8 mm apertures, dry or wet "
                                 "(Elskamp & Kruggel-Emden 2019).",
                                 options, sizeof options / sizeof *options, argc, argv);
    check_wish(&self, &w);
    complete_settings(&self, &w);
    st.kind = kind_of(&w);
    st.seeds = w.seeds;
    st.seed = self.seed * 1000003u;
    st.self = &self;
    st.samples = (int)(w.set.time / SAMPLE + 1e-9) + 1;
    plan(&st, &w.set);

    const int runs = st.variant_count * st.seeds, at_once = runs < self.threads ? runs : self.threads;
    program_need_spheres(&self, "mass", at_once * batch_spheres(&w.set));
    if (make_results(&st)) {
        common_fail("out of memory for %d seeds of %d samples", st.seeds, st.samples);
        return common_exit_status();
    }
    char path[4096];
    dem_io_series series;
    world_movie reel;
    if (st.kind != STUDY_ONE) open_runs(&st, path, sizeof path, w.resume);
    if (st.kind == STUDY_ONE && !w.no_frames) series = dem_io_open(self.out, "particles"), st.series = &series;
    if (st.kind == STUDY_ONE && w.film)
        reel = world_movie_open(self.out, "batch_screening.mp4", &screen_view), st.reel = &reel;
    const double started = machine_seconds();
    run_study(&st);
    if (st.series) dem_io_close(st.series);
    if (st.reel) world_movie_close(st.reel);
    if (!common_interrupted() && common_exit_status() == 0) report(&st, machine_seconds() - started);
    for (int k = 0; k < runs; k++) free(st.results[k].curve[0]);
    free(st.results);
    return common_exit_status();
}
