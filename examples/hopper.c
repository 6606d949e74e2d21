/* hopper - discharge of a silo at constant fill height, compared with Beverloo's law.

   Spheres fall into a cylinder whose orifice is closed, and come to rest. Then it opens. Spheres that leave are counted
   and fed again at the top, so that the rate is steady. Silos of one shape (width and fill height over the diameter D
   of the orifice) and several sizes give the exponent n of W ~ (D - k d)^n (Beverloo, Leniger & van de Velde 1961:
   n = 2.5, k about 1.4); others differ in the fill height only. --scene dosta: the silo of Dosta et al. (2024) with its
   Hertz-Mindlin parameters and --spheres of its 100 000 spheres, until it is empty or for --time.
   For your own hopper: the options, and the materials and walls in build(). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "dem.h"
#include "steady.h"
#include "world_picture.h"

enum { RUNS_MAX = 8, FRAMES = 40 };
static const double g = 9.81;
static const double orifices[] = {5.0, 6.5, 8.5, 11.0},
                    heights[] = {1.5, 2.5}; /* over the diameter; over the usual fill */

typedef struct silo {
    int dosta, material, spheres;     /* spheres: 0: as the height says */
    double diameter, spread, density; /* of the spheres [m], largest deviation from it [-], [kg/m3] */
    double width, slope;              /* diameter over the orifice's [-]; of the bottom [rad], 0: flat */
    double stiffness, restitution, friction, rolling; /* [N/m], [-], [-], lever arm [m] */
    double time;                                      /* longest discharge [s] */
    int passing;                                      /* spheres that a rate is taken from */
} silo;

static picture_def view = {{NULL}, 0, 0.6, {0.25, 1.0, -0.25}, {960, 640}};

typedef struct discharge {
    double orifice, radius, height;                  /* diameter, radius of the cylinder, fill [m] */
    double rate, error, bulk_density, filled, ended; /* [kg/s], standard error, [kg/m3], [kg], time of the end [s] */
    int spheres, passed, room;                       /* numbers; of those that passed there is room for */
    double *time, *mass;                             /* [passed] of each that fell out [s], sum so far [kg] */
    dem_status status;
    bool jammed;     /* an arch held, with spheres above it */
    const char *why; /* there is no rate; NULL */
} discharge;

typedef struct study {
    silo s;
    discharge run[RUNS_MAX];
    int runs, orifices,
        base; /* the first `orifices` runs differ in them; the others have the orifice of run `base` and more fill */
    const program *self;
    bool film;
    progress bar;
} study;

static int features(const silo *s) {
    return (s->dosta ? DEM_HERTZ : DEM_LINEAR) | DEM_FRICTION | (s->rolling > 0.0 ? DEM_ROLLING : 0);
}

/* Times and speeds over those that suit spheres of 5 mm. */
static double pace(const silo *s) { return s->dosta ? 1.0 : sqrt(s->diameter / 0.005); }

/* The bottom lies that deep below the cylinder's end. A flat one is a very flat cone. */
static double depth(const silo *s, const discharge *d) {
    return s->slope > 0.0 ? tan(s->slope) * (d->radius - 0.5 * d->orifice) : 1e-3 * s->diameter;
}

/* The cylinder, its bottom and the plane below at which spheres are counted. */
static dem_status build(dem_world *world, const silo *s, const discharge *d) {
    dem_def def = dem_default_def();
    def.allocator.fn = machine_resize;
    dem_add_material(&def, s->density, s->material == 2 ? 0.5e9 : 1e9, 0.2);
    dem_add_material(&def, 7200.0, 210e9, 0.2); /* steel */
    for (int k = 0; k < 2; k++) {
        dem_pair_def *p = dem_pair(&def, 0, k);
        p->stiffness = s->stiffness, p->restitution = s->restitution, p->friction = s->friction,
        p->rolling = s->rolling;
        if (s->dosta && k == 1) p->restitution = 0.4, p->friction = 0.2;
    }
    dem_status status = dem_init(world, &def, NULL);
    if (status != DEM_OK) return status;
    dem_cone bottom = dem_default_cone();
    bottom.low = dem_vec3(0, 0, -depth(s, d)), bottom.high = dem_vec3(0, 0, 0);
    bottom.low_radius = 0.5 * d->orifice, bottom.high_radius = d->radius;
    if (dem_add_cylinder(world, 1, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), d->radius, 1) < 0 ||
        dem_add_cone(world, 1, &bottom) < 0 ||
        dem_add_exit(world, dem_vec3(0, 0, -depth(s, d) - 2.0 * s->diameter), dem_vec3(0, 0, 1)) < 0)
        return DEM_TOO_MANY;
    return DEM_OK;
}

static double top_of(const dem_world *world) {
    double top = 0.0;
    for (ptrdiff_t i = 0; i < world->count; i++)
        top = fmax(top, world->alive[i] ? dem_position(world, i).z + dem_radius(world, i) : 0.0);
    return top;
}

/* Rains spheres in, layer upon layer, with the orifice shut, until there are enough, and waits until they rest. */
static dem_status fill(dem_world *world, const silo *s, discharge *d, dem_feed *feed, progress *bar, double work) {
    const double layer = 6.0 * s->diameter, speed = 0.5 * pace(s), step = layer / speed / 2.0,
                 volume = RIDDLE_PI * d->radius * d->radius;
    const int lid = dem_add_plane(world, 1, dem_vec3(0, 0, -depth(s, d)), dem_vec3(0, 0, 1));
    dem_status status = lid < 0 ? DEM_TOO_MANY : DEM_OK;
    feed->sizes = dem_uniform_sizes((1.0 - s->spread) * s->diameter, (1.0 + s->spread) * s->diameter, 0);
    feed->tries = 200;
    feed->velocity = dem_vec3(0, 0, -speed);
    const double mass = s->spheres ? s->spheres * RIDDLE_PI / 6.0 * s->density * pow(s->diameter, 3.0)
                                   : 0.58 * s->density * volume * d->height + 0.2 * s->density * volume * depth(s, d);
    while (status == DEM_OK && feed->placed_mass < mass && !common_interrupted()) {
        const double bottom = world->count     ? top_of(world)
                              : s->slope > 0.0 ? -0.5 * depth(s, d)
                                               : 0.0,
                     before = feed->placed_mass;
        feed->region = dem_cylinder_region(dem_vec3(0, 0, fmax(bottom, 0.0)), dem_vec3(0, 0, 1), layer, d->radius);
        status = dem_fill_mass(world, feed, fmin(0.25 * s->density * volume * layer, mass - before));
        if (status == DEM_OK && before == 0.0)
            status = dem_set_time_step(world, (s->dosta ? 1.0 : 2.0) * dem_advise(world, features(s), 1.0).advised);
        if (feed->placed_mass == before || status != DEM_OK) break;
        status = dem_run(world, step, features(s));
        progress_add(bar, 0.3 * work * (feed->placed_mass - before) / mass);
    }
    for (int k = 0; k < 50 && status == DEM_OK && !common_interrupted(); k++) {
        status = dem_run(world, 0.02 * pace(s), features(s));
        if (dem_energy(world).kinetic < 1e-3 * feed->placed_mass * g * s->diameter) break;
    }
    const dem_region lower = dem_cylinder_region(dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 0.6 * top_of(world), d->radius);
    dem_measure m;
    if (status == DEM_OK) status = dem_measure_region(world, &lower, &m);
    if (status == DEM_OK) d->bulk_density = m.solid_fraction * s->density;
    d->height = top_of(world);
    d->filled = feed->placed_mass;
    d->spheres = (int)feed->placed;
    return status == DEM_OK ? dem_enable_wall(world, lid, 0) : status;
}

/* The rate between two spheres that passed, or why there is none. */
static void find_rate(discharge *d, int first, int last) {
    const steady_flow f = steady_flow_of(d->time, d->mass, first, last);
    d->why = d->jammed      ? "an arch holds the rest"
             : !f.is_enough ? "too few spheres have passed"
             : !f.is_steady ? "the rate is not steady"
                            : NULL;
    d->rate = d->why ? (double)NAN : f.rate, d->error = d->why ? (double)NAN : f.error;
}

/* Takes the records of the spheres that fell out. */
static void take(dem_world *world, const silo *s, double begin, discharge *d) {
    const int all = d->passed + (int)world->passed_count;
    if (all > d->room) {
        const int room = 2 * all;
        double *time = realloc(d->time, (size_t)room * sizeof *time),
               *mass = time ? realloc(d->mass, (size_t)room * sizeof *mass) : NULL;
        d->time = time ? time : d->time, d->mass = mass ? mass : d->mass;
        if (!mass) {
            d->status = DEM_OUT_OF_MEMORY;
            return;
        }
        d->room = room;
    }
    for (int k = d->passed; k < all; k++) {
        const dem_passed *p = &world->passed[k - d->passed];
        d->time[k] = p->time - begin;
        d->mass[k] =
            (k ? d->mass[k - 1] : 0.0) + RIDDLE_PI / 6.0 * s->density * p->diameter * p->diameter * p->diameter;
    }
    dem_take_passed(world, NULL, world->passed_count);
    d->passed = all;
}

static int run(int index, void *user) {
    study *st = user;
    const silo *s = &st->s;
    discharge *d = &st->run[index];
    const double share = 1.0 / st->runs, sample = 0.01 * pace(s), start_up = 5.0 * sqrt(d->orifice / g);
    dem_world world;
    dem_feed feed = dem_default_feed();
    feed.random = st->self->seed + (uint64_t)index;
    memset(&world, 0, sizeof world);
    d->status = build(&world, s, d);
    if (d->status == DEM_OK) d->status = fill(&world, s, d, &feed, &st->bar, share);
    const double begin = world.time;
    const bool shown = index == 0, written = shown && !st->self->quick;
    dem_io_series series = {0};
    if (written && d->status == DEM_OK) series = dem_io_open(st->self->out, "particles");
    world_movie reel = {0};
    if (shown && st->film) reel = world_movie_open(st->self->out, "hopper.mp4", &view);
    double last_passing = 0.0, next_frame = 0.0, next_shot = 0.0, done = 0.0;
    bool pictured = false;
    int first = -1; /* that passed when the rate had become steady */
    feed.region = dem_cylinder_region(dem_vec3(0, 0, d->height), dem_vec3(0, 0, 1), 4.0 * s->diameter, d->radius);
    while (d->status == DEM_OK && !common_interrupted() && world.time - begin < s->time) {
        const int before = d->passed;
        if (shown && world.time - begin < 2.0 * pace(s) && world.time - begin >= next_shot) {
            world_movie_add(&reel, &world);
            next_shot += 0.02 * pace(s);
        }
        if (shown && !pictured && world.time - begin >= start_up)
            draw_world(&world, &view, st->self->out, "hopper.png"), pictured = true;
        if (series.particles && world.time - begin >= next_frame) {
            dem_io_add(&series, &world);
            next_frame = s->dosta ? next_frame + s->time / FRAMES : fmax(next_frame * 1.1, next_frame + 0.02 * pace(s));
        }
        d->status = dem_run(&world, sample, features(s));
        take(&world, s, begin, d);
        const int passed = d->passed;
        if (!s->dosta && d->status == DEM_OK)
            d->status = dem_feed_number(&world, &feed, (double)(passed - before) / sample, sample);
        if (passed > before) last_passing = world.time;
        if (first < 0 && world.time - begin >= start_up) first = passed;
        const double now = s->dosta    ? (world.time - begin) / s->time
                           : first < 0 ? 0.0
                                       : fmin((double)(passed - first) / s->passing, 1.0);
        progress_add(&st->bar, 0.7 * share * (now - done));
        done = now;
        if (!s->dosta && first >= 0 && passed - first >= s->passing) break;
        if (passed == feed.placed) break; /* empty */
        if (world.time - fmax(last_passing, begin) <= pace(s)) continue;
        d->jammed = passed < 0.9 * d->spheres || !s->dosta; /* on a flat bottom a rest stays */
        break;
    }
    if (shown && !pictured && d->status == DEM_OK) draw_world(&world, &view, st->self->out, "hopper.png");
    if (series.particles) dem_io_close(&series);
    world_movie_close(&reel);
    d->ended = world.time - begin;
    find_rate(d, first >= 0 ? first : d->passed,
              s->dosta && d->passed > 0.8 * d->spheres ? (int)(0.8 * d->spheres) : d->passed - 1);
    dem_free(&world);
    return d->status != DEM_OK;
}

/* Straight line y = a + b x by least squares; returns the sum of squares that is left. */
static double straight(int n, const double *x, const double *y, double *a, double *b) {
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, left = 0.0;
    for (int i = 0; i < n; i++) sx += x[i], sy += y[i], sxx += x[i] * x[i], sxy += x[i] * y[i];
    *b = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    *a = (sy - *b * sx) / n;
    for (int i = 0; i < n; i++) left += pow(y[i] - *a - *b * x[i], 2.0);
    return left;
}

/* The line through log W over log(D/d - k); returns the sum of squares that is left. */
static double logarithms(int n, const double *width, const double *rate, double k, double *a, double *b) {
    double x[RUNS_MAX] = {0.0}, y[RUNS_MAX] = {0.0};
    for (int i = 0; i < n; i++) x[i] = log(width[i] - k), y[i] = log(rate[i]);
    return straight(n, x, y, a, b);
}

/* What the rates through orifices of several widths D/d tell of W = C rho_b sqrt(g) (D - k d)^n. */
enum { EXPONENT, FREE_EXPONENT, FREE_K, K, CONSTANT, LOG_SCALE, ANSWERS };
typedef struct beverloo {
    double answer
        [ANSWERS]; /* n at the k that is given; n and k, both free; k and C, n = 2.5; log of W where D = (k + 1) d,
                      at the given k */
    double error[ANSWERS]; /* standard errors of them, from those of the rates */
} beverloo;

/* Of the orifices that have a rate. */
static void fit_to(const study *st, const double *rates, double k, double *answer) {
    const double d = st->s.diameter;
    double width[RUNS_MAX] = {0.0}, root[RUNS_MAX] = {0.0}, rate[RUNS_MAX] = {0.0}, density = 0.0, a, b, low = -3.0,
           high = orifices[0] - 0.2;
    int n = 0;
    for (int r = 0; r < st->orifices; r++) {
        if (isnan(rates[r])) continue;
        width[n] = st->run[r].orifice / d, rate[n] = rates[r], root[n] = pow(rates[r], 0.4);
        density += st->run[r].bulk_density;
        n++;
    }
    density /= n;
    for (int q = 0; q < ANSWERS; q++) answer[q] = (double)NAN;
    if (n < 2) return;
    logarithms(n, width, rate, k, &answer[LOG_SCALE], &answer[EXPONENT]);
    while (high - low > 1e-6) { /* of two points in between, the worse is the new end */
        const double third = (high - low) / 3.0, left = logarithms(n, width, rate, low + third, &a, &b);
        if (left < logarithms(n, width, rate, high - third, &a, &b)) high -= third;
        else low += third;
    }
    logarithms(n, width, rate, low, &a, &b);
    answer[FREE_K] = n > 2 ? low : (double)NAN, answer[FREE_EXPONENT] = n > 2 ? b : (double)NAN;
    straight(n, width, root, &a, &b);
    answer[K] = -a / b;
    answer[CONSTANT] = pow(b / d, 2.5) / (density * sqrt(g));
}

static beverloo fit(const study *st, double k) {
    beverloo b;
    double rate[RUNS_MAX], moved[ANSWERS];
    for (int r = 0; r < st->orifices; r++) rate[r] = st->run[r].rate;
    fit_to(st, rate, k, b.answer);
    memset(b.error, 0, sizeof b.error);
    for (int r = 0; r < st->orifices; r++) {
        if (isnan(rate[r])) continue;
        rate[r] += st->run[r].error;
        fit_to(st, rate, k, moved);
        rate[r] -= st->run[r].error;
        for (int q = 0; q < ANSWERS; q++) b.error[q] = hypot(b.error[q], moved[q] - b.answer[q]);
    }
    return b;
}

/* Rates over the orifice less k, and the law that was fitted. Two orifices fix any law: then it is not drawn. */
static void draw_law(riddle_plot *figure, const study *st, const beverloo *b, double k, const double *x,
                     const double *rate, const double *error) {
    enum { POINTS = 60 };
    const int n = st->orifices;
    double fine[POINTS], law[POINTS];
    char text[80];
    if (n < 3) return;
    for (int q = 0; q < POINTS; q++) {
        fine[q] = exp(log(0.8 * x[0]) + q / 59.0 * log(1.25 * 1.25 * x[n - 1] / x[0]));
        law[q] = exp(b->answer[LOG_SCALE] + b->answer[EXPONENT] * log(fine[q]));
    }
    riddle_plot_panel(figure, 1, 0, "orifice D over sphere d, less k [-]", "rate [kg/s]");
    riddle_plot_log_x(figure), riddle_plot_log_y(figure);
    snprintf(text, sizeof text, "exponent %.2f ± %.2f, k = %.3g", b->answer[EXPONENT], b->error[EXPONENT], k);
    riddle_plot_error_bars(figure, "rate", x, rate, error, n);
    riddle_plot_line(figure, text, fine, law, POINTS);
    riddle_plot_error_bars(figure, "higher fills", x + n, rate + n, error + n, st->runs - n);
}

static void report(study *st, double k) {
    static const result_column columns[] = {{"orifice_m", "orifice [mm]", "%.3g", 1e3},
                                            {"height_m", "fill [mm]", "%.3g", 1e3},
                                            {"rate_kg_s", "rate [kg/s]", "%.4g"},
                                            {"standard_error_kg_s", "standard error", "%.2g"},
                                            {"bulk_density_kg_m3", "bulk density [kg/m3]", "%.0f"},
                                            {"spheres", "spheres", "%.0f"},
                                            {"passed", "passed", "%.0f"},
                                            {"duration_s"},
                                            {"why_no_rate|", NULL, "%s"}};
    static const char *const answers[] = {"exponent", "exponent_of_free_k", "free_k", "k_of_exponent_2_5",
                                          "C_of_exponent_2_5"};
    const silo *s = &st->s;
    const int n_orifices = st->orifices;
    double x[RUNS_MAX] = {0.0}, y[RUNS_MAX] = {0.0}, error[RUNS_MAX];
    json *j = json_open(st->self->json);
    result_table *t = RESULTS(columns), *curves = results_of("orifice_m,height_m,time_s,mass_kg");
    riddle_plot *figure =
        riddle_plot_new(s->dosta ? "Silo of Dosta et al." : "Discharge of silos with a fill of constant height",
                        s->dosta || n_orifices < 3 ? 1 : 2, 1);
    riddle_plot_panel(figure, 0, 0, "time [s]", s->dosta ? "number left [-]" : "mass passed [kg]");
    for (int r = 0; r < st->runs; r++) {
        const discharge *d = &st->run[r];
        char name[80];
        results_row(t, TEXTS(d->why), d->orifice, d->height, d->rate, d->error, d->bulk_density, d->spheres, d->passed,
                    d->ended);
        for (int q = 0; q < d->passed; q++) results_row(curves, NULL, d->orifice, d->height, d->time[q], d->mass[q]);
        snprintf(name, sizeof name, "D = %.3g mm, fill %.3g mm", 1e3 * d->orifice, 1e3 * d->height);
        for (int q = 0; q < d->passed && s->dosta; q++) d->mass[q] = d->spheres - 1 - q;
        riddle_plot_line(figure, name, d->time, d->mass, d->passed);
        if (r >= n_orifices) riddle_plot_style(figure, RIDDLE_PLOT_DASHED, RIDDLE_PLOT_NEXT);
        x[r] = d->orifice / s->diameter - k, y[r] = d->rate, error[r] = d->error;
    }
    results_write(t, j, "runs", st->self->out, "rates.csv");
    results_csv(curves, st->self->out, "curves.csv");
    results_free(t), results_free(curves);
    for (int r = 0; r < st->runs; r++) {
        const discharge *d = &st->run[r];
        if (d->why)
            common_print("No rate of the orifice of %.3g mm under %.3g mm: %s (%d of %d passed in %.3g s).\n",
                         1e3 * d->orifice, 1e3 * d->height, d->why, d->passed, d->spheres, d->ended);
    }
    if (!s->dosta) {
        const beverloo b = fit(st, k);
        const double *a = b.answer, *e = b.error;
        const discharge *low = &st->run[st->base], *high = &st->run[st->runs - 1];
        const double ratio = high->rate / low->rate,
                     uncertain = ratio * hypot(high->error / high->rate, low->error / low->rate);
        char text[80];
        draw_law(figure, st, &b, k, x, y, error);
        if (n_orifices < 3) common_print("hopper.svg shows curves only: two orifices fix any law.\n");
        if (isfinite(a[EXPONENT]))
            common_print(
                "+- are standard errors. Exponent %.3f +- %.3f at k = %.3g; with exponent 2.5: k = %.3f +- %.3f, "
                "C = %.3f +- %.3f\n",
                a[EXPONENT], e[EXPONENT], k, a[K], e[K], a[CONSTANT], e[CONSTANT]);
        if (isfinite(a[FREE_EXPONENT]))
            common_print("both free: exponent %.2f +- %.2f, k = %.2f +- %.2f\n", a[FREE_EXPONENT], e[FREE_EXPONENT],
                         a[FREE_K], e[FREE_K]);
        if (isfinite(ratio))
            common_print("rate under a fill of %.3g mm over that under %.3g mm: %.3f +- %.3f\n", 1e3 * high->height,
                         1e3 * low->height, ratio, uncertain);
        for (int q = 0; q < LOG_SCALE; q++) {
            snprintf(text, sizeof text, "beverloo_%s", answers[q]);
            json_number(j, text, a[q]);
            snprintf(text, sizeof text, "standard_error_of_%s", answers[q]);
            json_number(j, text, e[q]);
        }
        json_number(j, "rate_high_over_low_fill", ratio);
        json_number(j, "standard_error_of_high_over_low", uncertain);
    }
    riddle_plot_write(figure, st->self->out, "hopper.svg");
    json_program(j, st->self);
    json_close(j);
}

int main(int argc, char **argv) {
    study st;
    memset(&st, 0, sizeof st);
    silo s = {0, 1, 0, 0.005, 0.1, 2500.0, 2.5, 0.0, 2000.0, 0.5, 0.5, 0.0, HUGE_VAL, 2500};
    double diameter = 5.0, slope = 0.0, height = 1.0, orifice = 40.0, k = 1.4, longest = 0.5;
    int spheres = 2000;
    option options[] = {
        option_choice("scene", &s.dosta, "beverloo|dosta",
                      "several orifices and fills, or one silo of Dosta et al. (2024)"),
        option_positive("diameter", "MM", &diameter, 1e3, "mean diameter of the spheres [mm]"),
        option_double("spread", "X", &s.spread, 0.0, 0.5, "largest deviation from it [-]"),
        option_double("width", "X", &s.width, 1.5, 20.0, "diameter of the silo over that of the orifice [-]"),
        option_double("height", "X", &height, 0.5, 20.0, "of the fill over the diameter of the orifice [-]"),
        option_double("slope", "DEG", &slope, 0.0, 85.0, "of a conical bottom, 0: flat [deg]"),
        option_positive("stiffness", "N/M", &s.stiffness, 1e9,
                        "of contacts, linear law [N/m]; default: 2000 for 5 mm, as d^2"),
        option_double("friction", "MU", &s.friction, 0.0, 10.0, "coefficient of friction [-]"),
        option_double("rolling", "M", &s.rolling, 0.0, 1.0, "lever arm of rolling resistance [m]"),
        option_int("passing", "N", &s.passing, 100, 10000000, "spheres that a rate is taken from"),
        option_double("k", "K", &k, 0.0, 4.0, "of (D - k d)^n [-]"),
        option_positive("orifice", "MM", &orifice, 199.0, "dosta: diameter of the orifice, 40 or 60 [mm]"),
        option_int("material", "N", &s.material, 1, 2, "dosta: M1 or M2"),
        option_int("spheres", "N", &spheres, 100, 10000000, "dosta: number of spheres, 100 000 in the paper"),
        option_positive("time", "S", &longest, 1e6, "dosta: longest discharge [s]"),
        option_flag("movie", &st.film, "hopper.mp4 of the first two seconds of the first run, half as fast, by ffmpeg"),
        option_size("size", view.size, "of the picture and the movie [pixels]"),
    };
    program self = program_start("hopper", "Discharge of a silo: Beverloo's law, rate and height of fill.", options,
                                 sizeof options / sizeof *options, argc, argv);
    if (!is_given(&self, "stiffness")) s.stiffness *= pow(diameter / 5.0, 2.0); /* the same overlaps over d */
    s.diameter = 1e-3 * diameter, s.slope = slope * RIDDLE_PI / 180.0;
    if (s.dosta) { /* the angle of the cone is not in the literature at hand: 45 degrees */
        s.diameter = 0.004, s.spread = 0.0, s.slope = is_given(&self, "slope") ? s.slope : 0.25 * RIDDLE_PI,
        s.rolling = 0.0;
        s.density = s.material == 2 ? 2000.0 : 2500.0, s.restitution = s.material == 2 ? 0.4 : 0.5;
        s.friction = s.material == 2 ? 0.4 : 0.3;
        s.spheres = self.quick && !is_given(&self, "spheres") ? 300 : spheres;
        s.time = self.quick && !is_given(&self, "time") ? 0.05 : longest;
        st.run[0].orifice = 1e-3 * orifice, st.run[0].radius = 0.1;
        st.runs = st.orifices = 1;
    } else {
        const int n = (int)(sizeof orifices / sizeof *orifices);
        s.time = HUGE_VAL;
        if (self.quick && !is_given(&self, "passing")) s.passing = 200;
        for (int r = 0; r < (self.quick ? 2 : n); r++) st.run[st.runs++].orifice = orifices[r] * s.diameter;
        st.orifices = st.runs, st.base = self.quick ? 0 : 1;
        for (int r = 0; r < (self.quick ? 1 : 2); r++) st.run[st.runs++].orifice = orifices[st.base] * s.diameter;
        for (int r = 0; r < st.runs; r++) {
            discharge *d = &st.run[r];
            d->radius = 0.5 * s.width * d->orifice;
            d->height = height * d->orifice * (r < st.orifices ? 1.0 : heights[r - st.orifices]);
        }
    }
    double most = 0.0; /* spheres of a run; a fill has a density of 0.6 */
    for (int r = 0; r < st.runs; r++)
        most = fmax(most, s.dosta ? s.spheres
                                  : 0.6 * 6.0 * st.run[r].radius * st.run[r].radius * st.run[r].height /
                                        pow(s.diameter, 3.0));
    program_need_spheres(&self, s.dosta ? "spheres" : "height",
                         most * (self.threads < st.runs ? self.threads : st.runs));
    st.s = s;
    st.self = &self;
    progress_begin(&st.bar, "running out", 1.0);
    jobs_run(st.runs, self.threads, run, &st);
    progress_end(&st.bar);
    for (int r = 0; r < st.runs; r++) {
        if (st.run[r].status != DEM_OK)
            common_fail("orifice %g mm: %s", 1e3 * st.run[r].orifice, dem_status_text(st.run[r].status));
    }
    if (common_exit_status() == 0) report(&st, k);
    for (int r = 0; r < st.runs; r++) free(st.run[r].time), free(st.run[r].mass);
    return common_exit_status();
}
