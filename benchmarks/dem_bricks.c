/* dem.h: cost of a bed of bricks, compared with as many clumps of two spheres and as many spheres.

   Bodies of 1 : 1 : 2.08 (a clump: two spheres that touch; a sphere: of the brick's volume) fall, turned at random,
   into a box that is periodic sideways, and settle. Then steps are timed at rest or on a vibrating floor. Figure of
   merit: particle-steps per second of processor time. state.csv holds the settled state, from which
   benchmarks/peers/bricks runs other programs. --rebounds measures the rebound of bricks from a plane instead, --pairs
   the time that touching pairs take. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "brick_bed.h"
#include "common.h"
#include "dem.h"
#include "riddle_io.h"
#include "dem_io.h"
#include "measure.h"

static const char *const shapes[] = {"brick", "clump", "sphere"};

/* The bodies' states: centre, quaternion of the shape's principal axes, velocity, spin. */
static void write_state(const dem_world *w, const char *out) {
    riddle_io_file *file =
        csv_open(out, "state.csv", "x_m,y_m,z_m,q_w,q_x,q_y,q_z,v_x_m_s,v_y_m_s,v_z_m_s,w_x_1_s,w_y_1_s,w_z_1_s");
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_vec x = dem_position(w, i), v = dem_velocity(w, i), s = dem_spin(w, i);
        const dem_quaternion q = dem_orientation(w, i);
        csv_line(file, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", x.x, x.y, x.z,
                 q.w, q.x, q.y, q.z, v.x, v.y, v.z, s.x, s.y, s.z);
    }
    riddle_io_close(file);
}

/* A picture of the bricks, bricks.png. */
static void draw(const dem_world *w, const char *out) {
    dem_io_surface s;
    if (dem_io_polyhedra_of(w, &s) != DEM_OK) return;
    picture *p = picture_new(960, 640);
    for (int k = 0; k < s.triangles; k++) {
        const int *t = s.triangle + 3 * k;
        picture_triangle(p, s.vertex + 3 * t[0], s.vertex + 3 * t[1], s.vertex + 3 * t[2],
                         picture_class(s.wall[t[0]] % 3), PICTURE_SOLID);
    }
    dem_io_free_surface(&s);
    picture_look(p, (double[3]){-0.4, 1.0, -0.5});
    picture_write(p, out, "bricks.png");
    picture_free(p);
}

/* Bricks that fall on a plane without gravity, turned at random: restitution of the centre and angle of the rebound. */
static dem_status rebound(double restitution, int hits, uint64_t *seed, double *mean, double *scatter, double *angle) {
    const double mass = 2080.0, k = mass / (0.01 * 0.01);
    double sum = 0.0, squares = 0.0, angles = 0.0;
    dem_status status = DEM_OK;
    for (int hit = 0; hit < hits && status == DEM_OK; hit++) {
        dem_def def = dem_default_def();
        dem_world w;
        dem_convex brick;
        const int m = dem_add_material(&def, 1000.0, 1e7, 0.3);
        dem_pair_def *pair = dem_pair(&def, m, m);
        const double at[3] = {0, 0, 1.3};
        const dem_quaternion turn = dem__random_turn(seed);
        const double q[4] = {turn.w, turn.x, turn.y, turn.z};
        pair->stiffness = k, pair->restitution = restitution, pair->friction = 0.8, pair->tangential_ratio = 0.78;
        def.dt = RIDDLE_PI * sqrt(mass / k) / 50.0, def.gravity = dem_vec3(0, 0, 0);
        status = dem_init(&w, &def, NULL);
        if (status == DEM_OK && dem_add_plane(&w, m, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) < 0)
            status = DEM_OUT_OF_MEMORY;
        if (status == DEM_OK) status = dem_make_brick(&brick, dem_vec3(1, 1, 2.08), 0.03, NULL);
        const int shape = status == DEM_OK ? dem_add_shape(&w, &brick) : 0;
        if (status == DEM_OK) status = shape < 0 ? (dem_status)-shape : dem_add_convex(&w, shape, 1, at, q, m, 0);
        if (status == DEM_OK) status = dem_set_motion(&w, 0, dem_vec3(0, 0, -1), dem_vec3(0, 0, 0));
        do status = status == DEM_OK ? dem_run(&w, 0.1, DEM_LINEAR | DEM_FRICTION) : status;
        while (status == DEM_OK && dem_position(&w, 0).z < 1.25 && w.time < 10.0);
        if (status == DEM_OK) {
            const dem_vec v = dem_velocity(&w, 0);
            const double turned = atan2(v.x, v.z) * 180.0 / RIDDLE_PI;
            sum += v.z, squares += v.z * v.z, angles += turned * turned;
        }
        dem_free(&w);
    }
    *mean = sum / hits, *scatter = sqrt(squares / hits - *mean * *mean), *angle = sqrt(angles / hits);
    return status;
}

/* The table of rebounds, rebound.csv. */
static int tell_rebounds(const program *self, int hits) {
    static const double e[5] = {0.29, 0.50, 0.65, 0.75, 0.90};
    uint64_t seed = self->seed;
    static const result_column columns[] = {{"restitution", "restitution", "%.2f"},
                                            {"mean", "mean", "%.3f"},
                                            {"scatter", "scatter", "%.3f"},
                                            {"angle_deg", "angle [degrees]", "%.1f"}};
    result_table *t = RESULTS(columns);
    for (int k = 0; k < 5; k++) {
        double mean, scatter, angle;
        const dem_status status = rebound(e[k], hits, &seed, &mean, &scatter, &angle);
        if (status != DEM_OK) return common_fail("%s", dem_status_text(status));
        results_row(t, NULL, e[k], mean, scatter, angle);
    }
    results_print(t);
    results_csv(t, self->out, "rebound.csv");
    riddle_plot *figure = riddle_plot_new("Bricks that hit a plane: speed after over before", 1, 1);
    riddle_plot_panel(figure, 0, 0, "restitution of the contact [-]", "coefficient of restitution of the brick [-]");
    riddle_plot_line(figure, "mean", e, results_column(t, "mean", 1.0), 5);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_line(figure, "standard deviation over orientations", e, results_column(t, "scatter", 1.0), 5);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_write(figure, self->out, "rebound.svg");
    results_free(t);
    return common_exit_status();
}

/* ---- touching pairs ---- */

static dem__placed placed(dem_vec x, dem_quaternion q) {
    const dem__axes axes = dem__axes_of(q);
    dem__placed p;
    p.x = x, p.axis[0] = axes.x, p.axis[1] = axes.y, p.axis[2] = axes.z;
    return p;
}

/* Distance along x at which two bricks, one of them off the axis by y and z, overlap by a tenth of their
   rounding [m]. */
static double touching_distance(const dem_convex *s, dem_quaternion qa, dem_quaternion qb, double y, double z) {
    dem__placed a = placed(dem_vec3(0, y, z), qa), b = placed(dem_vec3(0, 0, 0), qb);
    double in = 0.0, out = 2.0 * s->reach;
    for (int k = 0; k < 40; k++) {
        dem__gap_of_cores gap;
        a.x.x = 0.5 * (in + out);
        dem__find_gap(s, &a, s, &b, HUGE_VAL, NULL, &gap);
        if (gap.separation > 1.9 * s->radius) out = a.x.x;
        else in = a.x.x;
    }
    return out;
}

/* Adds n pairs that touch, far from each other: turned at random, or face on face, one turned about the
   other's normal. */
static dem_status add_pairs(dem_world *w, int shape, int n, int on_face, uint64_t *random) {
    const dem_convex *s = &w->engine->convex.shape[shape];
    dem_status status = DEM_OK;
    for (int k = 0; k < n && status == DEM_OK; k++) {
        double q[8], x[6] = {0};
        dem_quaternion turn[2];
        for (int m = 0; m < 2; m++) {
            const double angle = on_face ? m * dem__uniform(random) : 0.0; /* about x */
            turn[m] = on_face ? dem__quaternion(cos(angle), dem_vec3(sin(angle), 0, 0)) : dem__random_turn(random);
            q[4 * m] = turn[m].w, q[4 * m + 1] = turn[m].x, q[4 * m + 2] = turn[m].y, q[4 * m + 3] = turn[m].z;
        }
        for (int a = 1; a < 3; a++) x[a] = 0.2 * brick_edge * (dem__uniform(random) - 0.5);
        x[0] = touching_distance(s, turn[0], turn[1], x[1], x[2]);
        for (int m = 0; m < 2; m++)
            x[3 * m] += 10.0 * brick_edge * (k % 32), x[3 * m + 1] += 10.0 * brick_edge * (k / 32);
        status = dem_add_convex(w, shape, 2, x, q, 0, 0);
    }
    return status;
}

/* Time that the points of all pairs listed take, each so many times; cold: nothing is known of the step before [s]. */
static double time_points(dem_world *w, int times, int cold) {
    dem__convex_state *convex = &w->engine->convex;
    dem__convex_point point[DEM__POINTS_MAX];
    int64_t overlaps = 0;
    const double begun = machine_processor_seconds();
    for (int n = 0; n < times; n++) {
        for (ptrdiff_t k = 0; k < convex->of_particles; k++) {
            dem__convex_pair *p = &convex->pair[k];
            if (cold) p->axis = dem_vec3(0, 0, 0), p->cache.n = 0;
            dem__points_of_pair(w, p, w->step, point, &overlaps);
        }
    }
    return machine_processor_seconds() - begun;
}

/* Time of a touching pair [ns]: its points, with and without what the last step found, and all of a step;
   and its points. */
static dem_status time_pairs(int n, int on_face, uint64_t random, double ns[3], double *points) {
    enum { TIMES = 200, STEPS = 200 };
    dem_def def = dem_default_def();
    dem_world w;
    dem_convex brick;
    const int m = dem_add_material(&def, brick_density, 1e7, 0.3);
    dem_pair(&def, m, m)->stiffness = brick_stiffness, dem_pair(&def, m, m)->restitution = 0.3,
                      dem_pair(&def, m, m)->friction = 0.5;
    def.dt = 1e-9, def.threads = 1, def.gravity = dem_vec3(0, 0, 0); /* nothing moves far */
    dem_status status = dem_init(&w, &def, NULL);
    if (status == DEM_OK)
        status = dem_make_brick(&brick, dem_vec3(brick_edge, brick_edge, 2.08 * brick_edge), 0.03, NULL);
    const int shape = status == DEM_OK ? dem_add_shape(&w, &brick) : 0;
    if (status == DEM_OK) status = shape < 0 ? (dem_status)-shape : add_pairs(&w, shape, n, on_face, &random);
    if (status == DEM_OK) status = dem_run(&w, 10 * def.dt, DEM_LINEAR | DEM_FRICTION);
    if (status == DEM_OK) {
        const int64_t before = w.contact_steps;
        const double all = 1e9 / ((double)n * TIMES);
        ns[0] = all * time_points(&w, TIMES, 0), ns[1] = all * time_points(&w, TIMES, 1);
        const double begun = machine_processor_seconds();
        status = dem_run(&w, STEPS * def.dt, DEM_LINEAR | DEM_FRICTION);
        ns[2] = 1e9 * (machine_processor_seconds() - begun) / ((double)n * STEPS);
        *points = (double)(w.contact_steps - before) / ((double)n * STEPS);
    }
    dem_free(&w);
    return status;
}

/* The table of pairs, pairs.csv. */
static int tell_pairs(const program *self, int n) {
    static const char *const kinds[2] = {"turned at random", "face on face"};
    static const result_column columns[] = {{"pair", "pair", "%s"},
                                            {"points", "points", "%.2f"},
                                            {"known_ns", "its points [ns]", "%.0f"},
                                            {"new_ns", "without the step before [ns]", "%.0f"},
                                            {"step_ns", "all of a step [ns]", "%.0f"}};
    const double number[2] = {1, 2};
    result_table *t = RESULTS(columns);
    for (int k = 0; k < 2; k++) {
        double ns[3], points;
        const dem_status status = time_pairs(n, k, self->seed, ns, &points);
        if (status != DEM_OK) return common_fail("%s", dem_status_text(status));
        results_row(t, TEXTS(kinds[k]), points, ns[0], ns[1], ns[2]);
    }
    results_print(t);
    results_csv(t, self->out, "pairs.csv");
    const double *known = results_column(t, "known_ns", 1.0), *fresh = results_column(t, "new_ns", 1.0),
                 *step = results_column(t, "step_ns", 1.0);
    riddle_plot *figure = riddle_plot_new("A touching pair of bricks", 1, 1);
    riddle_plot_panel(figure, 0, 0, "1: turned at random, 2: face on face", "processor time [ns]");
    riddle_plot_points(figure, "its points", number, known, 2);
    riddle_plot_points(figure, "without the step before", number, fresh, 2);
    riddle_plot_points(figure, "all of a step", number, step, 2);
    riddle_plot_write(figure, self->out, "pairs.svg");
    json *report = json_open(self->json);
    json_array(report, "points_ns", known, 2), json_array(report, "points_new_ns", fresh, 2),
        json_array(report, "step_ns", step, 2);
    json_program(report, self);
    json_close(report);
    results_free(t);
    return common_exit_status();
}

/* Runs for a time [s] and draws the kinetic energy: are the bodies at rest? */
static dem_status settle_down(dem_world *w, const program *self, double time) {
    enum { PARTS = 100 };
    double t[PARTS], energy[PARTS];
    int n = 0;
    dem_status status = DEM_OK;
    progress bar;
    progress_begin(&bar, "settling", PARTS);
    while (n < PARTS && status == DEM_OK && !common_interrupted()) {
        status = dem_run(w, time / PARTS, DEM_LINEAR | DEM_FRICTION);
        const dem_energy_ledger now = dem_energy(w);
        t[n] = 1e3 * w->time, energy[n++] = 1e9 * (now.kinetic + now.rotational) / (double)w->count;
        progress_add(&bar, 1.0);
    }
    progress_end(&bar);
    riddle_plot *figure = riddle_plot_new("A bed that settles", 1, 1);
    riddle_plot_panel(figure, 0, 0, "time [ms]", "kinetic energy a particle [nJ]");
    riddle_plot_log_y(figure);
    riddle_plot_line(figure, NULL, t, energy, n);
    riddle_plot_write(figure, self->out, "settling.svg");
    return status;
}

/* Times steps, says what they took and writes it down. */
static dem_status time_steps(dem_world *w, const char *shape, int bodies, int steps, json *report) {
    const double dt = w->def.dt;
    dem_status status = dem_run(w, 10 * dt, DEM_LINEAR | DEM_FRICTION);
    const int64_t contacts = w->contact_steps, lists = w->rebuilds;
    const double begun = machine_processor_seconds();
    if (status == DEM_OK) status = dem_run(w, steps * dt, DEM_LINEAR | DEM_FRICTION);
    const double taken = machine_processor_seconds() - begun;
    if (status != DEM_OK) return status;
    const double rate = (double)bodies * steps / taken, touching = (double)(w->contact_steps - contacts) / steps;
    const dem_energy_ledger energy = dem_energy(w);
    common_print("%s: %d bodies, %.0f contacts, %d steps, %.3g s, %.4g particle-steps/s, %.0f ns a contact, %lld "
                 "lists, %lld cores overlap\n",
                 shape, bodies, touching, steps, taken, rate, 1e9 * taken / (touching * steps),
                 (long long)(w->rebuilds - lists), (long long)dem_core_overlaps(w));
    results_values(report, {"contacts", touching}, {"cpu_s", taken}, {"particle_steps_per_s", rate},
                   {"kinetic_energy_J", energy.kinetic + energy.rotational});
    return status;
}

int main(int argc, char **argv) {
    int bodies = 490, steps = 2000, shape = 0, hits = 0, pairs = 0, tiles = 1;
    double settle = 0.12, shake = 0.0;
    option options[] = {
        option_choice("shape", &shape, "brick|clump|sphere", "what the bodies are"),
        option_int("bodies", "N", &bodies, 49, 100000, "how many settle, 49 a layer"),
        option_int("tiles", "N", &tiles, 1, 30, "N x N copies of the settled bed, beside each other, are timed"),
        option_double("settle-s", "S", &settle, 0.0, 10.0, "time to settle [s]"),
        option_double("amplitude-m", "M", &shake, 0.0, 0.01, "of the floor, at 50 Hz, while steps are timed [m]"),
        option_int("steps", "N", &steps, 10, 1000000, "time steps that are timed"),
        option_int("rebounds", "N", &hits, 0, 100000,
                   "instead: so many bricks fall on a plane, one by one, for each of five restitutions"),
        option_int("pairs", "N", &pairs, 0, 1000, "instead: the time of so many touching pairs of bricks"),
    };
    program self = program_start("dem_bricks", "dem.h: cost of a bed of bricks or clumps.", options,
                                 sizeof options / sizeof *options, argc, argv);
    if (hits > 0) return tell_rebounds(&self, hits);
    if (pairs > 0) return tell_pairs(&self, pairs);
    if (self.quick && !is_given(&self, "bodies")) bodies = 98;
    if (self.quick && !is_given(&self, "settle-s")) settle = 0.05;
    dem_world world;
    int floor_wall;
    memset(&world, 0, sizeof world);
    dem_status status = brick_box(&world, BRICKS_ACROSS * brick_spacing, &floor_wall);
    if (status == DEM_OK) status = brick_add_layers(&world, shape, bodies, self.seed);
    status = status == DEM_OK ? settle_down(&world, &self, settle) : status;
    if (status == DEM_OK && tiles > 1)
        status = brick_repeat(&world, shape, tiles, BRICKS_ACROSS * brick_spacing, &floor_wall);
    bodies *= tiles * tiles;
    if (status == DEM_OK) write_state(&world, self.out);
    if (status == DEM_OK && shape == 0) draw(&world, self.out);
    json *report = json_open(self.json);
    json_string(report, "shape", shapes[shape]);
    json_integer(report, "bodies", bodies);
    json_integer(report, "steps", steps);
    if (shake > 0.0 && status == DEM_OK)
        status = dem_vibrate(&world, floor_wall, dem_vec3(0, 0, shake), dem_vec3(0, 0, 0), 50.0);
    if (status == DEM_OK) status = time_steps(&world, shapes[shape], bodies, steps, report);
    if (status == DEM_OK) {
        json_program(report, &self);
        json_close(report);
    } else {
        json_discard(report);
        common_fail("%s", dem_status_text(status));
    }
    dem_free(&world);
    return common_exit_status();
}
