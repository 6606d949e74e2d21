/* dem.h: cost of a bed of bricks, compared with as many clumps of two spheres and as many spheres.

   Bodies of 1 : 1 : 2.08 (a clump: two spheres that touch; a sphere: of the brick's volume) fall, turned at random, into a box that is
   periodic sideways, and settle. Then steps are timed at rest or on a vibrating floor. Figure of merit: particle-steps per second of
   processor time. state.csv holds the settled state, from which benchmarks/peers/bricks runs other programs. --rebounds measures the
   rebound of bricks from a plane instead. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "dem.h"
#include "riddle_io.h"
#include "dem_io.h"
#include "measure.h"

static const double edge = 2e-3, density = 2500.0, stiffness = 1e4, spacing = 5.2e-3;
enum { ACROSS = 7 }; /* bodies of a layer, along each side */
static const char *const shapes[] = {"brick", "clump", "sphere"};

static double uniform(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 9007199254740992.0;
}

static dem_status add_bodies(dem_world *w, int shape, int n, uint64_t seed) {
    dem_convex brick;
    dem_clump clump;
    const double ball = edge * 0.5 * 1.58375586998611, two = ball * 1.58740105196820 * 0.5; /* radii: of one, of each of two */
    const double centres[6] = {0, 0, -two, 0, 0, two}, diameters[2] = {2.0 * two, 2.0 * two};
    dem_status status = dem_make_brick(&brick, dem_vec3(edge, edge, 2.08 * edge), 0.03, NULL);
    if (status == DEM_OK) status = dem_make_clump(2, centres, diameters, &clump);
    const int number = status == DEM_OK && shape == 0 ? dem_add_shape(w, &brick) : 0;
    if (number < 0) return (dem_status)-number;
    for (int k = 0; k < n && status == DEM_OK; k++) {
        const int layer = k / (ACROSS * ACROSS);
        const double at[3] = {(0.5 + k % ACROSS) * spacing, (0.5 + k / ACROSS % ACROSS) * spacing, (0.6 + layer) * spacing};
        const double q[4] = {uniform(&seed) - 0.5, uniform(&seed) - 0.5, uniform(&seed) - 0.5, uniform(&seed) - 0.5}, d = 2.0 * ball;
        if (shape == 0) status = dem_add_convex(w, number, 1, at, q, 0, 0);
        else if (shape == 1) status = dem_add_clumps(w, 1, &clump, at, NULL, q, 0, 0);
        else status = dem_add_spheres(w, 1, at, &d, 0, 0);
        if (status == DEM_OK) status = dem_set_motion(w, w->count - 1, dem_vec3(0, 0, -0.3), dem_vec3(0, 0, 0));
    }
    return status;
}

/* The bodies' states: centre, quaternion of the shape's principal axes, velocity, spin. */
static void write_state(const dem_world *w, const char *out) {
    csv *file = csv_open(out, "state.csv", "x_m,y_m,z_m,q_w,q_x,q_y,q_z,v_x_m_s,v_y_m_s,v_z_m_s,w_x_1_s,w_y_1_s,w_z_1_s");
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_vec x = dem_position(w, i), v = dem_velocity(w, i), s = dem_spin(w, i);
        const dem_quaternion q = dem_orientation(w, i);
        csv_line(file, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g", x.x, x.y, x.z, q.w, q.x, q.y, q.z,
                 v.x, v.y, v.z, s.x, s.y, s.z);
    }
    csv_close(file);
}

/* A picture of the bricks, bricks.png. */
static void draw(const dem_world *w, const char *out) {
    dem_io_surface s;
    if (dem_io_polyhedra_of(w, &s) != DEM_OK) return;
    picture *p = picture_new(960, 640);
    for (int k = 0; k < s.triangles; k++) {
        const int *t = s.triangle + 3 * k;
        picture_triangle(p, s.vertex + 3 * t[0], s.vertex + 3 * t[1], s.vertex + 3 * t[2], picture_class(s.wall[t[0]] % 3), PICTURE_SOLID);
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
        double q[4], size;
        pair->stiffness = k, pair->restitution = restitution, pair->friction = 0.8, pair->tangential_ratio = 0.78;
        def.dt = RIDDLE_PI * sqrt(mass / k) / 50.0, def.gravity = dem_vec3(0, 0, 0);
        do { /* evenly over all orientations: within a ball */
            for (int a = 0; a < 4; a++) q[a] = 2.0 * uniform(seed) - 1.0;
            size = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        } while (!(size <= 1.0 && size > 1e-3));
        status = dem_init(&w, &def, NULL);
        if (status == DEM_OK && dem_add_plane(&w, m, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) < 0) status = DEM_OUT_OF_MEMORY;
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
    double means[5], scatters[5];
    csv *file = csv_open(self->out, "rebound.csv", "restitution,mean,scatter,angle_deg");
    for (int k = 0; k < 5; k++) {
        double mean, scatter, angle;
        const dem_status status = rebound(e[k], hits, &seed, &mean, &scatter, &angle);
        if (status != DEM_OK) return common_fail("%s", dem_status_text(status));
        csv_line(file, "%.2f,%.5g,%.5g,%.5g", e[k], mean, scatter, angle);
        means[k] = mean, scatters[k] = scatter;
        common_print("restitution %.2f: %.3f +- %.3f, angle %.1f degrees\n", e[k], mean, scatter, angle);
    }
    csv_close(file);
    plot *figure = plot_new("Bricks that hit a plane: speed after over before", 1, 1);
    plot_panel(figure, 0, 0, "restitution of the contact [-]", "coefficient of restitution of the brick [-]");
    plot_line(figure, "mean", e, means, 5);
    plot_style(figure, PLOT_MARKED, PLOT_NEXT);
    plot_line(figure, "standard deviation over orientations", e, scatters, 5);
    plot_style(figure, PLOT_MARKED, PLOT_NEXT);
    plot_write(figure, self->out, "rebound.svg");
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
    plot *figure = plot_new("A bed that settles", 1, 1);
    plot_panel(figure, 0, 0, "time [ms]", "kinetic energy a particle [nJ]");
    plot_log_y(figure);
    plot_line(figure, NULL, t, energy, n);
    plot_write(figure, self->out, "settling.svg");
    return status;
}

int main(int argc, char **argv) {
    int bodies = 490, steps = 2000, shape = 0, hits = 0;
    double settle = 0.12, shake = 0.0;
    option options[] = {
        option_choice("shape", &shape, "brick|clump|sphere", "what the bodies are"),
        option_int("bodies", "N", &bodies, 49, 100000, "how many"),
        option_double("settle-s", "S", &settle, 0.0, 10.0, "time to settle [s]"),
        option_double("amplitude-m", "M", &shake, 0.0, 0.01, "of the floor, at 50 Hz, while steps are timed [m]"),
        option_int("steps", "N", &steps, 10, 1000000, "time steps that are timed"),
        option_int("rebounds", "N", &hits, 0, 100000, "instead: so many bricks fall on a plane, one by one, for each of five restitutions"),
    };
    program self =
        program_start("dem_bricks", "dem.h: cost of a bed of bricks or clumps.", options, sizeof options / sizeof *options, argc, argv);
    if (hits > 0) return tell_rebounds(&self, hits);
    if (self.quick && !options[1].given) bodies = 98;
    if (self.quick && !options[2].given) settle = 0.05;
    dem_def def = dem_default_def();
    dem_world world;
    const int material = dem_add_material(&def, density, 1e7, 0.3);
    dem_pair_def *pair = dem_pair(&def, material, material);
    pair->stiffness = stiffness, pair->restitution = 0.3, pair->friction = 0.5;
    def.dt = 3e-6, def.threads = 1;
    def.periodic[0] = def.periodic[1] = 1;
    def.high.x = def.high.y = ACROSS * spacing;
    dem_status status = dem_init(&world, &def, NULL);
    const int floor_wall = status == DEM_OK ? dem_add_plane(&world, material, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) : 0;
    if (status == DEM_OK) status = add_bodies(&world, shape, bodies, self.seed);
    status = status == DEM_OK ? settle_down(&world, &self, settle) : status;
    if (status == DEM_OK) write_state(&world, self.out);
    if (status == DEM_OK && shape == 0) draw(&world, self.out);
    if (shake > 0.0 && status == DEM_OK) status = dem_vibrate(&world, floor_wall, dem_vec3(0, 0, shake), dem_vec3(0, 0, 0), 50.0);
    if (status == DEM_OK) status = dem_run(&world, 10 * def.dt, DEM_LINEAR | DEM_FRICTION);
    const int64_t contacts = world.contact_steps, lists = world.rebuilds;
    const double begun = machine_processor_seconds();
    if (status == DEM_OK) status = dem_run(&world, steps * def.dt, DEM_LINEAR | DEM_FRICTION);
    const double taken = machine_processor_seconds() - begun;
    if (status != DEM_OK) return common_fail("%s", dem_status_text(status));
    const double rate = (double)bodies * steps / taken, touching = (double)(world.contact_steps - contacts) / steps;
    const dem_energy_ledger energy = dem_energy(&world);
    common_print(
        "%s: %d bodies, %.0f contacts, %d steps, %.3g s, %.4g particle-steps/s, %.0f ns a contact, %lld lists, %lld cores overlap\n",
        shapes[shape], bodies, touching, steps, taken, rate, 1e9 * taken / (touching * steps), (long long)(world.rebuilds - lists),
        (long long)dem_core_overlaps(&world));
    json *report = json_open(self.json);
    json_string(report, "shape", shapes[shape]);
    json_integer(report, "bodies", bodies);
    json_number(report, "contacts", touching);
    json_integer(report, "steps", steps);
    json_number(report, "cpu_s", taken);
    json_number(report, "particle_steps_per_s", rate);
    json_number(report, "kinetic_energy_J", energy.kinetic + energy.rotational);
    json_program(report, &self);
    json_close(report);
    dem_free(&world);
    return common_exit_status();
}
