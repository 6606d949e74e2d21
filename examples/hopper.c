/* hopper - a silo runs empty: Beverloo's law, and that the height of the fill does not matter.

   Spheres are rained into a cylinder with a flat or conical bottom, whose orifice is shut, and come to rest. Then it is opened, and
   what falls out is counted. Some runs have orifices of several diameters D: their rates give the exponent n of W ~ (D - k d)^n
   (Beverloo, Leniger & van de Velde 1961: n = 2.5, k about 1.4), others the same orifice under lower fills. --scene dosta: the silo of
   Dosta et al. (2024) with its Hertz-Mindlin parameters, as many of its 100 000 spheres as --spheres says, run until empty or for
   --time. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "dem.h"

enum { RUNS_MAX = 8, BLOCKS = 5, FRAMES = 40 };
static const double g = 9.81;
static const double orifices[] = {4.5, 5.5, 6.5, 8.0}, heights[] = {0.5, 0.75};

typedef struct silo {
    int dosta, material, spheres;                     /* spheres: 0: as the height says */
    double diameter, spread, density;                 /* of the spheres [m], largest deviation from it [-], [kg/m3] */
    double radius, funnel, height;                    /* of the cylinder, height of the cone below it or 0, of the fill above it [m] */
    double stiffness, restitution, friction, rolling; /* [N/m], [-], [-], lever arm [m] */
    double time;                                      /* longest discharge [s] */
    int passing;                                      /* spheres after which a rate is known */
} silo;

typedef struct discharge {
    double orifice, height;                          /* diameter [m], fill at rest [m] */
    double rate, error, bulk_density, filled, ended; /* [kg/s], standard error, [kg/m3], [kg], time of the end [s] */
    int spheres, passing, passed;                    /* passing: after which it ends */
    double *time, *mass;                             /* [passed] of each that fell out [s], sum so far [kg] */
    dem_status status;
} discharge;

typedef struct study {
    silo s;
    discharge run[RUNS_MAX];
    int runs;
    const program *self;
    progress bar;
} study;

static int features(const silo *s) { return (s->dosta ? DEM_HERTZ : DEM_LINEAR) | DEM_FRICTION | (s->rolling > 0.0 ? DEM_ROLLING : 0); }

/* The cylinder, its bottom and the plane below at which spheres are counted. */
static dem_status build(dem_world *world, const silo *s, double orifice) {
    dem_def def = dem_default_def();
    dem_add_material(&def, s->density, s->material == 2 ? 0.5e9 : 1e9, 0.2);
    dem_add_material(&def, 7200.0, 210e9, 0.2); /* steel */
    for (int k = 0; k < 2; k++) {
        dem_pair_def *p = dem_pair(&def, 0, k);
        p->stiffness = s->stiffness, p->restitution = s->restitution, p->friction = s->friction, p->rolling = s->rolling;
        if (s->dosta && k == 1) p->restitution = 0.4, p->friction = 0.2;
    }
    dem_status status = dem_init(world, &def, NULL);
    if (status != DEM_OK) return status;
    dem_cone bottom = dem_default_cone();
    const double depth = s->funnel > 0.0 ? s->funnel : 1e-3 * s->diameter; /* a flat bottom is a very flat cone */
    bottom.low = dem_vec3(0, 0, -depth), bottom.high = dem_vec3(0, 0, 0);
    bottom.low_radius = 0.5 * orifice, bottom.high_radius = s->radius;
    if (dem_add_cylinder(world, 1, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), s->radius, 1) < 0 || dem_add_cone(world, 1, &bottom) < 0 ||
        dem_add_exit(world, dem_vec3(0, 0, -depth - 2.0 * s->diameter), dem_vec3(0, 0, 1)) < 0)
        return DEM_TOO_MANY;
    return DEM_OK;
}

static double top_of(const dem_world *world) {
    double top = 0.0;
    for (ptrdiff_t i = 0; i < world->count; i++) top = fmax(top, world->alive[i] ? dem_position(world, i).z + world->radius[i] : 0.0);
    return top;
}

/* Rains spheres in, layer upon layer, with the orifice shut, until there are enough, and waits until they rest. */
static dem_status fill(dem_world *world, const silo *s, discharge *d, uint64_t seed, progress *bar, double work) {
    const double layer = 6.0 * s->diameter, speed = 0.5, step = layer / speed / 2.0;
    const int lid = dem_add_plane(world, 1, dem_vec3(0, 0, s->funnel > 0.0 ? -s->funnel : -1e-3 * s->diameter), dem_vec3(0, 0, 1));
    const double volume = RIDDLE_PI * s->radius * s->radius, expected = 0.58 * s->density * volume * d->height;
    dem_feed feed = dem_default_feed();
    dem_status status = lid < 0 ? DEM_TOO_MANY : DEM_OK;
    feed.sizes = dem_uniform_sizes((1.0 - s->spread) * s->diameter, (1.0 + s->spread) * s->diameter, 0);
    feed.random = seed;
    feed.tries = 200;
    feed.velocity = dem_vec3(0, 0, -speed);
    const double mass = s->spheres ? s->spheres * RIDDLE_PI / 6.0 * s->density * pow(s->diameter, 3.0)
                                   : expected + 0.4 * s->density * RIDDLE_PI / 3.0 * s->funnel * s->radius * s->radius;
    while (status == DEM_OK && feed.placed_mass < mass && !common_interrupted()) {
        const double bottom = world->count ? top_of(world) : s->funnel > 0.0 ? -0.5 * s->funnel : 0.0, before = feed.placed_mass;
        feed.region = dem_cylinder_region(dem_vec3(0, 0, fmax(bottom, 0.0)), dem_vec3(0, 0, 1), layer, s->radius);
        status = dem_fill_mass(world, &feed, fmin(0.25 * s->density * volume * layer, mass - before));
        if (status == DEM_OK && before == 0.0) status = dem_set_time_step(world, dem_advise(world, features(s), 1.0).advised);
        if (feed.placed_mass == before || status != DEM_OK) break;
        status = dem_run(world, step, features(s));
        progress_add(bar, 0.4 * work * (feed.placed_mass - before) / mass);
    }
    for (int k = 0; k < 50 && status == DEM_OK && !common_interrupted(); k++) {
        status = dem_run(world, 0.02, features(s));
        if (dem_energy(world).kinetic < 1e-5 * feed.placed_mass * g * s->diameter) break;
    }
    const dem_region lower = dem_cylinder_region(dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 0.6 * top_of(world), s->radius);
    dem_measure m;
    if (status == DEM_OK) status = dem_measure_region(world, &lower, &m);
    if (status == DEM_OK) d->bulk_density = m.solid_fraction * s->density;
    d->height = top_of(world);
    d->filled = feed.placed_mass;
    d->spheres = (int)feed.placed;
    return status == DEM_OK ? dem_enable_wall(world, lid, 0) : status;
}

static void write_frame(const dem_world *world, const char *folder, pvd *series, double time) {
    const ptrdiff_t n = world->count;
    double *buffer = malloc((size_t)(7 * n + 1) * sizeof *buffer), *x = buffer, *v = buffer + 3 * n, *d = buffer + 6 * n;
    int m = 0;
    if (!buffer) common_fail("out of memory for a frame");
    for (ptrdiff_t i = 0; i < n && buffer; i++) {
        if (!world->alive[i]) continue;
        const dem_vec at = dem_position(world, i), u = dem_velocity(world, i);
        x[3 * m] = at.x, x[3 * m + 1] = at.y, x[3 * m + 2] = at.z;
        v[3 * m] = u.x, v[3 * m + 1] = u.y, v[3 * m + 2] = u.z;
        d[m++] = 2.0 * world->radius[i];
    }
    const vtk_array arrays[] = {vtk_scalar("diameter_m", d), vtk_vector("velocity_m_s", v)};
    if (buffer) vtp_points(folder, pvd_name(series, time), m, vtk_vector("position", x), arrays, 2);
    free(buffer);
}

/* Rate over the last four fifths of what passed: mean and standard error of equal parts of the time. */
static void find_rate(discharge *d) {
    const int first = d->passed / 5, last = d->passed - 1;
    double sum = 0.0, square = 0.0;
    d->rate = d->error = (double)NAN;
    if (d->passed < 20 * BLOCKS) return;
    const double from = d->time[first], size = (d->time[last] - from) / BLOCKS;
    for (int b = 0, k = first; b < BLOCKS; b++) {
        const int begin = k;
        while (k < last && d->time[k] < from + (b + 1) * size) k++;
        const double rate = (d->mass[k] - d->mass[begin]) / size;
        sum += rate, square += rate * rate;
    }
    d->rate = (d->mass[last] - d->mass[first]) / (d->time[last] - from);
    d->error = sqrt(fmax(square / BLOCKS - sum * sum / BLOCKS / BLOCKS, 0.0) / (BLOCKS - 1));
}

static int run(int index, void *user) {
    study *st = user;
    const silo *s = &st->s;
    discharge *d = &st->run[index];
    const double share = 1.0 / st->runs, sample = 0.01;
    dem_world world;
    memset(&world, 0, sizeof world);
    d->status = build(&world, s, d->orifice);
    if (d->status == DEM_OK) d->status = fill(&world, s, d, st->self->seed + (uint64_t)index, &st->bar, share);
    const double begin = world.time;
    pvd *series = index == 0 && !st->self->quick ? pvd_open(st->self->out, "particles.pvd") : NULL;
    double last_passing = 0.0, next_frame = 0.0, done = 0.0;
    while (d->status == DEM_OK && !common_interrupted() && world.time - begin < s->time) {
        const ptrdiff_t before = world.passed_count;
        if (series && world.time - begin >= next_frame) {
            write_frame(&world, st->self->out, series, world.time - begin);
            next_frame = s->dosta ? next_frame + s->time / FRAMES : fmax(next_frame * 1.1, next_frame + 0.02);
        }
        d->status = dem_run(&world, sample, features(s));
        if (world.passed_count > before) last_passing = world.time;
        const double now = s->dosta ? (world.time - begin) / s->time : fmin((double)world.passed_count / d->passing, 1.0);
        progress_add(&st->bar, 0.6 * share * (now - done));
        done = now;
        if (!s->dosta && world.passed_count >= d->passing) break;
        if (world.passed_count == d->spheres || world.time - fmax(last_passing, begin) > 1.0) break; /* empty, or an arch holds */
    }
    pvd_close(series);
    d->ended = world.time - begin;
    d->passed = (int)world.passed_count;
    d->time = malloc((size_t)(d->passed + 1) * 2 * sizeof *d->time);
    if (!d->time) d->passed = 0;
    d->mass = d->time + d->passed;
    for (int k = 0; k < d->passed; k++) {
        const dem_passed *p = &world.passed[k];
        d->time[k] = p->time - begin;
        d->mass[k] = (k ? d->mass[k - 1] : 0.0) + RIDDLE_PI / 6.0 * s->density * p->diameter * p->diameter * p->diameter;
    }
    find_rate(d);
    dem_free(&world);
    return d->status != DEM_OK;
}

/* Straight line y = a + b x by least squares. */
static void straight(int n, const double *x, const double *y, double *a, double *b) {
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    for (int k = 0; k < n; k++) sx += x[k], sy += y[k], sxx += x[k] * x[k], sxy += x[k] * y[k];
    *b = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    *a = (sy - *b * sx) / n;
}

/* Exponent at a given k; k and C if the exponent is 2.5. */
typedef struct beverloo {
    double exponent, rate_at_1mm, k, constant;
} beverloo;

static beverloo fit(const study *st, int n, double k) {
    double x[RUNS_MAX], y[RUNS_MAX], root[RUNS_MAX], width[RUNS_MAX], a, density = 0.0;
    beverloo b;
    for (int r = 0; r < n; r++) {
        const discharge *d = &st->run[r];
        x[r] = log(d->orifice - k * st->s.diameter), y[r] = log(d->rate);
        width[r] = d->orifice, root[r] = pow(d->rate, 0.4);
        density += d->bulk_density / n;
    }
    straight(n, x, y, &a, &b.exponent);
    b.rate_at_1mm = exp(a + b.exponent * log(1e-3));
    straight(n, width, root, &a, &b.constant);
    b.k = -a / b.constant / st->s.diameter;
    b.constant = pow(b.constant, 2.5) / (density * sqrt(g));
    return b;
}

static void report(study *st, int n_orifices, double k) {
    const silo *s = &st->s;
    const beverloo b = fit(st, n_orifices, k);
    double low = HUGE_VAL, high = 0.0, x[RUNS_MAX], y[RUNS_MAX], error[RUNS_MAX], fine[60], law[60];
    json *j = json_open(st->self->json);
    csv *rates = csv_open(st->self->out, "rates.csv",
                          "orifice_m,height_m,rate_kg_s,standard_error_kg_s,bulk_density_kg_m3,spheres,passed,duration_s");
    csv *curves = csv_open(st->self->out, "curves.csv", "orifice_m,height_m,time_s,mass_kg");
    table t = table_begin("orifice [mm]|fill [mm]|spheres|passed|rate [kg/s]|standard error|bulk density [kg/m3]");
    plot *figure = plot_new(s->dosta ? "Silo of Dosta et al." : "Discharge of a silo", 1, s->dosta ? 1 : 2);
    plot_panel(figure, 0, 0, "time [s]", s->dosta ? "number left [-]" : "mass passed [kg]");
    json_array_begin(j, "runs");
    for (int r = 0; r < st->runs; r++) {
        const discharge *d = &st->run[r];
        char name[80];
        const double row[] = {d->orifice, d->height, d->rate, d->error, d->bulk_density, d->spheres, d->passed, d->ended};
        csv_row(rates, row, 8);
        for (size_t c = 0; c < 8; c++) {
            static const char *const keys[] = {"orifice_m",          "height_m", "rate_kg_s", "standard_error_kg_s",
                                               "bulk_density_kg_m3", "spheres",  "passed",    "duration_s"};
            if (c == 0) json_object_begin(j, NULL);
            json_number(j, keys[c], row[c]);
            if (c == 7) json_object_end(j);
        }
        for (int q = 0; q < d->passed; q++) csv_line(curves, "%.9g,%.9g,%.9g,%.9g", d->orifice, d->height, d->time[q], d->mass[q]);
        table_cell(&t, "%.1f", 1e3 * d->orifice);
        table_cell(&t, "%.0f", 1e3 * d->height);
        table_cell(&t, "%d", d->spheres);
        table_cell(&t, "%d", d->passed);
        table_cell(&t, "%.4f", d->rate);
        table_cell(&t, "%.4f", d->error);
        table_cell(&t, "%.0f", d->bulk_density);
        snprintf(name, sizeof name, "D = %.3g mm, fill %.3g mm", 1e3 * d->orifice, 1e3 * d->height);
        for (int q = 0; q < d->passed && s->dosta; q++) d->mass[q] = d->spheres - 1 - q;
        plot_line(figure, name, d->time, d->mass, d->passed);
        if (r >= n_orifices) plot_style(figure, PLOT_DASHED, PLOT_NEXT);
        if (d->orifice == st->run[st->runs - 1].orifice) low = fmin(low, d->rate), high = fmax(high, d->rate);
        x[r] = 1e3 * (d->orifice - k * s->diameter), y[r] = d->rate, error[r] = d->error;
    }
    json_array_end(j);
    table_end(&t);
    csv_close(rates);
    csv_close(curves);
    if (!s->dosta) {
        for (int q = 0; q < 60; q++) {
            fine[q] = exp(log(0.8 * x[0]) + q / 59.0 * log(1.25 * 1.25 * x[n_orifices - 1] / x[0]));
            law[q] = b.rate_at_1mm * pow(fine[q], b.exponent);
        }
        char text[80];
        plot_panel(figure, 0, 1, "D - k d [mm]", "rate [kg/s]");
        plot_log_x(figure), plot_log_y(figure);
        snprintf(text, sizeof text, "exponent %.3f at k = %.3g", b.exponent, k);
        plot_error_bars(figure, "rate", x, y, error, n_orifices);
        plot_line(figure, text, fine, law, 60);
        plot_error_bars(figure, "lower fills", x + n_orifices, y + n_orifices, error + n_orifices, st->runs - n_orifices);
        common_print(
            "exponent %.3f at k = %.3g; with exponent 2.5: k = %.3f, C = %.3f. Rates under %d fills of one orifice: within %.1f %%\n",
            b.exponent, k, b.k, b.constant, st->runs - n_orifices + 1, 100.0 * (high / low - 1.0));
        json_number(j, "beverloo_exponent", b.exponent);
        json_number(j, "beverloo_k_of_exponent_2_5", b.k);
        json_number(j, "beverloo_C_of_exponent_2_5", b.constant);
        json_number(j, "rate_spread_over_heights", high / low - 1.0);
    }
    plot_write(figure, st->self->out, "hopper.svg");
    json_program(j, st->self);
    json_close(j);
}

int main(int argc, char **argv) {
    silo s = {0, 1, 0, 0.005, 0.1, 2500.0, 0.0425, 0.0, 0.085, 500.0, 0.5, 0.5, 0.0, 20.0, 500};
    double diameter = 5.0, radius = 42.5, funnel = 0.0, height = 85.0, orifice = 40.0, k = 1.4;
    option options[] = {
        option_choice("scene", &s.dosta, "beverloo|dosta", "several orifices and fills, or one silo of Dosta et al. (2024)"),
        option_positive("diameter", "MM", &diameter, 1e3, "mean diameter of the spheres [mm]"),
        option_double("spread", "X", &s.spread, 0.0, 0.5, "largest deviation from it [-]"),
        option_positive("radius", "MM", &radius, 1e5, "of the cylinder [mm]"),
        option_double("funnel", "MM", &funnel, 0.0, 1e5, "height of a conical bottom, 0: flat [mm]"),
        option_positive("height", "MM", &height, 1e5, "of the fill above the bottom's rim [mm]"),
        option_positive("stiffness", "N/M", &s.stiffness, 1e9, "of contacts, linear law [N/m]"),
        option_double("friction", "MU", &s.friction, 0.0, 10.0, "coefficient of friction [-]"),
        option_double("rolling", "M", &s.rolling, 0.0, 1.0, "lever arm of rolling resistance [m]"),
        option_int("passing", "N", &s.passing, 100, 10000000,
                   "spheres through the smallest orifice; more through wider ones, as its area to the 3/4"),
        option_double("k", "K", &k, 0.0, 4.0, "of (D - k d)^n [-]"),
        option_positive("orifice", "MM", &orifice, 1e5, "dosta: diameter of the orifice, 40 or 60 [mm]"),
        option_int("material", "N", &s.material, 1, 2, "dosta: M1 or M2"),
        option_int("spheres", "N", &s.spheres, 100, 10000000, "dosta: number of spheres, 100 000 in the paper"),
        option_positive("time", "S", &s.time, 1e6, "longest discharge [s]"),
    };
    program self = program_start("hopper", "Discharge of a silo: Beverloo's law, rate and height of fill.", options,
                                 sizeof options / sizeof *options, argc, argv);
    int n_orifices = 0;
    study st;
    memset(&st, 0, sizeof st);
    s.diameter = 1e-3 * diameter, s.radius = 1e-3 * radius, s.funnel = 1e-3 * funnel, s.height = 1e-3 * height;
    if (s.dosta) { /* the angle of the cone is not in the literature at hand: 45 degrees */
        s.diameter = 0.004, s.spread = 0.0, s.radius = 0.1, s.funnel = 0.1 - 0.5e-3 * orifice, s.rolling = 0.0;
        s.density = s.material == 2 ? 2000.0 : 2500.0, s.restitution = s.material == 2 ? 0.4 : 0.5,
        s.friction = s.material == 2 ? 0.4 : 0.3;
        s.spheres = options[13].given ? s.spheres : self.quick ? 300 : 2000;
        s.time = options[14].given ? s.time : self.quick ? 0.05 : 0.5;
        if (!(s.funnel > 0.0)) program_refuse(&self, "orifice", NULL, "below 200 mm");
        st.run[0].orifice = 1e-3 * orifice;
        st.runs = n_orifices = 1;
    } else {
        const int n = (int)(sizeof orifices / sizeof *orifices);
        if (!(s.radius >= 5.0 * s.diameter))
            program_refuse(&self, "radius", NULL, "at least 5 diameters, so that the largest orifice fits");
        if (!(k < orifices[0])) program_refuse(&self, "k", NULL, "below 4.5");
        if (self.quick) s.passing = options[9].given ? s.passing : 120, s.height *= options[5].given ? 1.0 : 0.4;
        for (int r = 0; r < n; r++) { /* quick: two orifices and one lower fill */
            if (!self.quick || r % 2) st.run[st.runs++].orifice = orifices[r] * s.diameter;
        }
        n_orifices = st.runs;
        for (int r = 0; r < (self.quick ? 1 : 2); r++) st.run[st.runs++].orifice = orifices[self.quick ? 1 : n - 1] * s.diameter;
        for (int r = 0; r < st.runs; r++) {
            st.run[r].height = r < n_orifices ? s.height : s.height * heights[self.quick ? 1 : r - n_orifices];
            st.run[r].passing = (int)(s.passing * pow(st.run[r].orifice / (orifices[0] * s.diameter), 1.5));
        }
    }
    st.s = s;
    st.self = &self;
    progress_begin(&st.bar, "running out", 1.0);
    jobs_run(st.runs, self.threads, run, &st);
    progress_end(&st.bar);
    for (int r = 0; r < st.runs; r++) {
        if (st.run[r].status != DEM_OK) common_fail("orifice %g mm: %s", 1e3 * st.run[r].orifice, dem_status_text(st.run[r].status));
    }
    if (common_exit_status() == 0) report(&st, n_orifices, k);
    for (int r = 0; r < st.runs; r++) free(st.run[r].time);
    return common_exit_status();
}
