/* rotating_drum - two species in a rotating drum: segregation over time, and the dynamic angle of repose.

   Small and large spheres (or light and heavy ones) fall into the lower half of a drum between two flat ends, mixed or
   small on the left and large on the right (--start), and the drum turns. Results over time: Lacey's index in a grid of
   cells, the share of unlike contacts, the radial segregation (how much nearer to the middle of the bed the small ones
   are), and the slope of the free surface.
   For your own drum: the options, the materials in build(), and dem_add_box in build() for lifters
   (examples/first/my_drum.c has some). --scene dosta: the drum of Dosta et al. (2024), R 0.1 m, 2 rad/s, Hertz-Mindlin,
   M2 of 4 mm and M1 of 2 mm; --scale reduces numbers and drum width together (1: 8000 and 30 000 spheres in 60 mm). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "dem.h"
#include "steady.h"
#include "world_picture.h"

enum { SMALL, LARGE, SPECIES, CELLS = 24, SAMPLES_MAX = 2000 };

typedef struct drum {
    int dosta, start;                           /* start: 0 mixed, 1 side by side */
    double diameter[SPECIES], density[SPECIES]; /* [m], [kg/m3] */
    int count[SPECIES];
    double radius, width, speed, turns, fill;         /* [m], [m], [rad/s], [-], share of the drum's volume */
    double stiffness, restitution, friction, rolling; /* [N/m], [-], [-], lever arm [m] */
} drum;

static picture_def view = {{"small", "large"}, SPECIES, 0.0, {0.35, 1.0, -0.18}, {960, 640}};

typedef struct curves {
    int n;
    double time[SAMPLES_MAX], lacey[SAMPLES_MAX], unlike[SAMPLES_MAX], radial[SAMPLES_MAX], angle[SAMPLES_MAX];
    double quadrant[SPECIES][4][SAMPLES_MAX]; /* numbers; 0: x, z > 0, then counter-clockwise */
} curves;

static int features(const drum *d) {
    return (d->dosta ? DEM_HERTZ : DEM_LINEAR) | DEM_FRICTION | (d->rolling > 0.0 ? DEM_ROLLING : 0);
}

static dem_status build(dem_world *world, const drum *d, int *wall) {
    dem_def def = dem_default_def();
    def.allocator.fn = machine_resize;
    for (int s = 0; s < SPECIES; s++) dem_add_material(&def, d->density[s], d->dosta && s == LARGE ? 0.5e9 : 1e9, 0.2);
    dem_add_material(&def, 7200.0, 210e9, 0.2); /* steel */
    for (int a = 0; a <= SPECIES; a++) {
        for (int b = a; b <= SPECIES; b++) {
            dem_pair_def *p = dem_pair(&def, a, b);
            p->stiffness = d->stiffness, p->restitution = d->restitution, p->friction = d->friction,
            p->rolling = d->rolling;
            if (!d->dosta) continue;
            p->restitution = b == SPECIES ? 0.4 : a != b ? 0.45 : a == SMALL ? 0.5 : 0.4;
            p->friction = b == SPECIES ? 0.2 : a != b ? 0.2 : a == SMALL ? 0.3 : 0.4;
        }
    }
    dem_status status = dem_init(world, &def, NULL);
    if (status != DEM_OK) return status;
    *wall = dem_add_cylinder(world, SPECIES, dem_vec3(0, 0, 0), dem_vec3(0, 1, 0), d->radius, 1);
    const int ends[2] = {dem_add_plane(world, SPECIES, dem_vec3(0, -0.5 * d->width, 0), dem_vec3(0, 1, 0)),
                         dem_add_plane(world, SPECIES, dem_vec3(0, 0.5 * d->width, 0), dem_vec3(0, -1, 0))};
    if (*wall < 0 || ends[0] < 0 || ends[1] < 0) return DEM_TOO_MANY;
    return DEM_OK;
}

/* Shares of both species, in turns, at random places in the drum, as often as it takes: what is there sinks
   while more comes. */
static dem_status fill(dem_world *world, const drum *d, uint64_t seed, progress *bar, double work) {
    const double half = 0.5 * d->width, side = 0.7 * d->radius;
    dem_feed feed[SPECIES];
    ptrdiff_t wanted = d->count[SMALL] + d->count[LARGE];
    dem_status status = DEM_OK;
    for (int s = 0; s < SPECIES; s++) {
        feed[s] = dem_default_feed();
        feed[s].sizes = dem_uniform_sizes(0.95 * d->diameter[s], 1.05 * d->diameter[s], 0);
        if (d->dosta) feed[s].sizes = dem_one_size(d->diameter[s]);
        feed[s].material = feed[s].group = s;
        feed[s].random = seed + 1000 * (uint64_t)s;
        feed[s].tries = 30;
        const double left = d->start && s == LARGE ? 0.0 : -side, right = d->start && s == SMALL ? 0.0 : side;
        feed[s].region = dem_box_region(dem_vec3(left, -half, -side), dem_vec3(right, half, side));
    }
    for (int round = 0; round < 400 && wanted > 0 && status == DEM_OK && !common_interrupted(); round++) {
        const ptrdiff_t before = wanted;
        for (int s = SPECIES - 1; s >= 0 && status == DEM_OK;
             s--) { /* the large ones first; no more of one than of the other, by share */
            const ptrdiff_t placed = feed[s].placed,
                            due = (ptrdiff_t)ceil(fmin(0.1 * (round + 1), 1.0) * d->count[s]) - placed;
            if (due > 0) status = dem_fill(world, &feed[s], due);
            wanted -= feed[s].placed - placed;
        }
        if (status == DEM_OK && round == 0)
            status = dem_set_time_step(world, dem_advise(world, features(d), 1.0).advised);
        if (status == DEM_OK) status = dem_run(world, 0.03, features(d));
        progress_add(bar, work * (double)(before - wanted) / (double)(d->count[SMALL] + d->count[LARGE]));
    }
    if (status == DEM_OK) status = dem_run(world, 0.1, features(d));
    return wanted > 0 && status == DEM_OK && !common_interrupted() ? DEM_BAD_ARGUMENT : status;
}

/* The spheres of a table: group 0 are the small ones. */
static dem_status take(dem_world *world, const drum *d, const particles *given) {
    dem_status status = DEM_OK;
    for (int i = 0; i < given->n && status == DEM_OK; i++) {
        const double *v = given->velocity + 3 * (size_t)i, *w = given->spin + 3 * (size_t)i;
        const int species = given->group[i] ? LARGE : SMALL;
        status = dem_add_spheres(world, 1, given->centre + 3 * (size_t)i, &given->diameter[i], species, species);
        if (status == DEM_OK)
            status = dem_set_motion(world, world->count - 1, dem_vec3(v[0], v[1], v[2]), dem_vec3(w[0], w[1], w[2]));
    }
    if (status == DEM_OK) status = dem_set_time_step(world, dem_advise(world, features(d), 1.0).advised);
    return status == DEM_OK ? dem_run(world, 0.0, features(d)) : status;
}

/* Slope of the free surface in the middle half of the drum [degrees]: a line through the highest sphere
   of each strip. */
static double surface_angle(const dem_world *world, const drum *d) {
    enum { STRIPS = 16 };
    double top[STRIPS], sx = 0.0, sz = 0.0, sxx = 0.0, sxz = 0.0, n = 0.0;
    const double reach = 0.5 * d->radius;
    for (int k = 0; k < STRIPS; k++) top[k] = -HUGE_VAL;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        const dem_vec x = dem_position(world, i);
        const int k = (int)floor((x.x + reach) / (2.0 * reach) * STRIPS);
        if (k >= 0 && k < STRIPS && world->touching[i] > 1)
            top[k] = fmax(top[k], x.z); /* those in flight are not the surface */
    }
    for (int k = 0; k < STRIPS; k++) {
        const double x = (k + 0.5) / STRIPS * 2.0 * reach - reach;
        if (top[k] > -HUGE_VAL) n += 1.0, sx += x, sz += top[k], sxx += x * x, sxz += x * top[k];
    }
    return atan(fabs((n * sxz - sx * sz) / (n * sxx - sx * sx))) * 180.0 / RIDDLE_PI;
}

/* Mean distance of the large from the middle of the bed less that of the small, over the mean of all: 0 mixed. */
static double radial_segregation(const dem_world *world) {
    double mass = 0.0, n[SPECIES] = {0.0}, r[SPECIES] = {0.0};
    dem_vec centre = dem_vec3(0, 0, 0);
    for (ptrdiff_t i = 0; i < world->count; i++) {
        const dem_vec x = dem_position(world, i);
        centre.x += dem_mass(world, i) * x.x, centre.z += dem_mass(world, i) * x.z, mass += dem_mass(world, i);
    }
    for (ptrdiff_t i = 0; i < world->count; i++) {
        const dem_vec x = dem_position(world, i);
        n[world->group[i]] += 1.0, r[world->group[i]] += hypot(x.x - centre.x / mass, x.z - centre.z / mass);
    }
    return (r[LARGE] / n[LARGE] - r[SMALL] / n[SMALL]) / ((r[SMALL] + r[LARGE]) / (n[SMALL] + n[LARGE]));
}

static void look(curves *c, const dem_world *world, const drum *d, double time) {
    double of_small[CELLS * CELLS], of_all[CELLS * CELLS];
    const int across = (int)fmin(fmax(d->radius / (1.5 * d->diameter[LARGE]), 4.0), (double)CELLS), k = c->n++;
    const dem_cells cells = {dem_vec3(-d->radius, -d->width, -d->radius),
                             dem_vec3(d->radius, d->width, d->radius),
                             {across, 1, across},
                             {0, 0, 0}};
    dem_count_in_cells(world, &cells, SMALL, of_small, of_all);
    c->time[k] = time;
    c->lacey[k] = dem_mixing_of(across * across, of_small, of_all).lacey;
    c->unlike[k] = dem_unlike_contacts(world, SMALL);
    c->radial[k] = radial_segregation(world);
    c->angle[k] = surface_angle(world, d);
    for (int q = 0; q < 4; q++) c->quadrant[SMALL][q][k] = c->quadrant[LARGE][q][k] = 0.0;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        const dem_vec x = dem_position(world, i);
        c->quadrant[world->group[i]][x.z > 0.0 ? (x.x > 0.0 ? 0 : 1) : (x.x > 0.0 ? 3 : 2)][k] += 1.0;
    }
}

/* Means of the second half of the time; scatter: standard deviation of the angle in time. */
typedef struct means {
    steady_mean angle, lacey, unlike, radial;
    double scatter;
    const char *why; /* the angle has no mean; NULL */
} means;
static means means_of(const curves *c, const drum *d) {
    const int first = c->n / 2, n = c->n - first;
    means m = {steady_mean_of(c->angle + first, n),
               steady_mean_of(c->lacey + first, n),
               steady_mean_of(c->unlike + first, n),
               steady_mean_of(c->radial + first, n),
               0.0,
               NULL};
    double square = 0.0;
    for (int k = first; k < c->n; k++) square += (c->angle[k] - m.angle.mean) * (c->angle[k] - m.angle.mean) / n;
    m.scatter = sqrt(square);
    m.why = d->turns < 0.5       ? "the bed has not begun to flow: turn the drum by half a turn at least (--turns)"
            : !m.angle.is_steady ? "it still changes: let the drum turn longer (--turns)"
                                 : NULL;
    return m;
}

static void draw(const curves *c, const dem_world *world, const drum *d, const char *out, const means *m) {
    char text[80];
    riddle_plot *figure = riddle_plot_new(d->dosta ? "Drum of Dosta et al." : "Two sizes in a drum", 2, 2);
    riddle_plot_panel(figure, 0, 0, "time [s]", "index [-]");
    riddle_plot_line(figure, "Lacey (1: mixed)", c->time, c->lacey, c->n);
    riddle_plot_line(figure, "unlike contacts (1: mixed)", c->time, c->unlike, c->n);
    riddle_plot_line(figure, "radial segregation", c->time, c->radial, c->n);
    riddle_plot_panel(figure, 0, 1, "time [s]", "slope of the surface [°]");
    if (m->why) snprintf(text, sizeof text, "no mean yet");
    else snprintf(text, sizeof text, "mean of the second half: %.1f ± %.1f°", m->angle.mean, m->angle.error);
    riddle_plot_line(figure, NULL, c->time, c->angle, c->n);
    riddle_plot_range_y(figure, 0.0, 60.0);
    if (!m->why) riddle_plot_horizontal(figure, NULL, m->angle.mean);
    riddle_plot_text_share(figure, 0.28, 0.92, text);
    riddle_plot_panel(figure, 1, 0, "time [s]", "small spheres [-]");
    for (int q = 0; q < 4; q++) {
        static const char *const names[] = {"upper right", "upper left", "lower left", "lower right"};
        riddle_plot_line(figure, names[q], c->time, c->quadrant[SMALL][q], c->n);
    }
    riddle_plot_panel(figure, 1, 1, NULL, NULL);
    dem_io_section(world, figure, dem_vec3(0, 0, 0), dem_vec3(0, -1, 0), dem_vec3(1, 0, 0), view.names, SPECIES);
    riddle_plot_write(figure, out, "rotating_drum.svg");
}

/* ---- the scene, as the options say ---- */

/* The drum of Dosta et al. (2024), with a share of its spheres and of its width. */
static void choose_dosta(drum *d, double scale, double time) {
    d->diameter[SMALL] = 0.002, d->diameter[LARGE] = 0.004, d->density[LARGE] = 2000.0, d->rolling = 0.0;
    d->radius = 0.1, d->width = 0.06 * scale, d->speed = 2.0, d->turns = time * d->speed / (2.0 * RIDDLE_PI);
    d->count[SMALL] = (int)(30000 * scale), d->count[LARGE] = (int)(8000 * scale);
}

/* Half of the solid volume for each species; 0.58 of the bed is solid. */
static void count_by_fill(drum *d, const program *self) {
    for (int s = 0; s < SPECIES; s++) {
        const double wanted = 0.5 * 0.58 * d->fill * d->radius * d->radius * d->width * 6.0 / pow(d->diameter[s], 3.0);
        if (!(wanted <= 1e7))
            program_refuse(self, s == SMALL ? "small" : "large", NULL, "such that 10 000 000 spheres are enough");
        d->count[s] = (int)wanted;
    }
}

static void read_spheres(drum *d, const program *self, const char *from, particles *given) {
    char message[400], allowed[500];
    if (particles_read(from, given, message, sizeof message) != 0) {
        snprintf(allowed, sizeof allowed, "a readable file of particles (%s)", message);
        program_refuse(self, "from", from, allowed);
    }
    d->count[SMALL] = d->count[LARGE] = 0;
    for (int i = 0; i < given->n; i++) d->count[given->group[i] ? LARGE : SMALL]++;
}

static void check(const drum *d, const program *self, const char *from) {
    if (!(d->width > 1.4999999 * d->diameter[LARGE] &&
          d->radius > 3.0 * d->diameter[LARGE])) /* 1.5 itself passes: dosta's default */
        program_refuse(self, "large", NULL, "below a third of the drum's radius and at most two thirds of its width");
    if (d->count[SMALL] < 10 || d->count[LARGE] < 10)
        program_refuse(self, from ? "from" : "fill", from, "enough for ten spheres of each species");
    program_need_spheres(self, from ? "from" : d->dosta ? "scale" : "small", (double)d->count[SMALL] + d->count[LARGE]);
}

/* ---- the run and its results ---- */

/* Turns the drum, whose wall and two ends begin at number `wall`. */
static dem_status turn(dem_world *world, const drum *d, int wall, const program *self, bool film, bool page,
                       progress *bar, curves *c) {
    const double duration = d->turns * 2.0 * RIDDLE_PI / d->speed,
                 sample = fmax(duration / (SAMPLES_MAX - 2), self->quick ? 0.01 : 0.02);
    const int samples = (int)(duration / sample + 0.5);
    dem_status status = DEM_OK;
    for (int k = 0; k < 3 && status == DEM_OK; k++)
        status = dem_rotate(world, wall + k, dem_vec3(0, 0, 0), dem_vec3(0, 1, 0), d->speed);
    dem_io_series series = dem_io_open(self->out, "particles");
    world_movie reel = film ? world_movie_open(self->out, "rotating_drum.mp4", &view) : (world_movie){0};
    world_movie small = page ? world_movie_open(self->out, "rotating_drum_turning.png", &view) : (world_movie){0};
    for (int k = 0; k <= samples && status == DEM_OK && !common_interrupted(); k++) {
        if (k > 0) status = dem_run(world, sample, features(d));
        look(c, world, d, k * sample);
        if (k % (samples / 50 + 1) == 0) dem_io_add(&series, world);
        world_movie_add(&reel, world);
        if (k % 2 == 0) world_movie_add(&small, world);
        progress_add(bar, 0.8 / (samples + 1));
    }
    dem_io_close(&series);
    world_movie_close(&reel);
    world_movie_close(&small);
    return status;
}

static void write_curves(const curves *c, const char *out) {
    riddle_io_file *file =
        csv_open(out, "rotating_drum.csv",
                 "time_s,lacey,unlike_contacts,radial_segregation,surface_angle_deg,small_upper_right,small_upper_left,"
                 "small_lower_left,"
                 "small_lower_right,large_upper_right,large_upper_left,large_lower_left,large_lower_right");
    for (int k = 0; k < c->n; k++) {
        double row[13] = {c->time[k], c->lacey[k], c->unlike[k], c->radial[k], c->angle[k]};
        for (int q = 0; q < 8; q++) row[5 + q] = c->quadrant[q / 4][q % 4][k];
        riddle_io_row(file, row, 13);
    }
    riddle_io_close(file);
}

static void write_json(const program *self, const drum *d, const dem_world *world, const curves *c, const means *m) {
    json *j = json_open(self->json);
    results_values(j, {"small_spheres", d->count[SMALL]}, {"large_spheres", d->count[LARGE]},
                   {"angle_of_repose_deg", m->why ? (double)NAN : m->angle.mean},
                   {"angle_standard_error_deg", m->why ? (double)NAN : m->angle.error},
                   {"angle_scatter_deg", m->scatter}, {"lacey_start", c->lacey[0]}, {"lacey_end", m->lacey.mean},
                   {"unlike_contacts_start", c->unlike[0]}, {"unlike_contacts_end", m->unlike.mean},
                   {"radial_segregation_start", c->radial[0]}, {"radial_segregation_end", m->radial.mean},
                   {"dt_s", world->def.dt});
    json_string(j, "why_no_angle", m->why);
    json_bool(j, "lacey_steady", m->lacey.is_steady);
    json_bool(j, "unlike_contacts_steady", m->unlike.is_steady);
    json_bool(j, "radial_segregation_steady", m->radial.is_steady);
    json_array(j, "time_s", c->time, c->n);
    json_array(j, "lacey", c->lacey, c->n);
    json_program(j, self);
    json_close(j);
}

static void report(const program *self, const drum *d, const dem_world *world, const curves *c) {
    const means m = means_of(c, d);
    char angle[200];
    write_curves(c, self->out);
    draw(c, world, d, self->out, &m);
    draw_world(world, &view, self->out, "rotating_drum.png");
    if (m.why) snprintf(angle, sizeof angle, "no angle: %s", m.why);
    else
        snprintf(angle, sizeof angle, "angle %.1f degrees (standard error %.1f; it scatters by %.1f in time)",
                 m.angle.mean, m.angle.error, m.scatter);
    common_print("%d small, %d large spheres, %.3g turns, dt %.3g s. Second half of the time: %s, Lacey %.3f%s, unlike "
                 "contacts %.3f%s, radial "
                 "segregation %.3f%s (at first %.3f, %.3f, %.3f)\n",
                 d->count[SMALL], d->count[LARGE], d->turns, world->def.dt, angle, m.lacey.mean,
                 m.lacey.is_steady ? "" : " and changing", m.unlike.mean, m.unlike.is_steady ? "" : " and changing",
                 m.radial.mean, m.radial.is_steady ? "" : " and changing", c->lacey[0], c->unlike[0], c->radial[0]);
    write_json(self, d, world, c, &m);
}

int main(int argc, char **argv) {
    drum d = {0, 0, {0.003, 0.006}, {2500.0, 2500.0}, {0, 0}, 0.05, 0.02, 4.0, 3.0, 0.4, 300.0, 0.5, 0.5, 0.0};
    const char *from = NULL;
    bool film = false, page = false;
    particles given = {0};
    double small = 3.0, large = 6.0, radius = 50.0, width = 20.0, scale = 0.1, time = 0.1;
    option options[] = {
        option_choice("scene", &d.dosta, "sizes|dosta",
                      "two sizes of one material, or the drum of Dosta et al. (2024)"),
        option_choice("start", &d.start, "mixed|sides", "how the species lie at first"),
        option_positive("small", "MM", &small, 1e3, "diameter of the first species [mm]"),
        option_positive("large", "MM", &large, 1e3, "diameter of the second species [mm]"),
        option_positive("density-small", "KG/M3", &d.density[SMALL], 1e5, "of the first species [kg/m3]"),
        option_positive("density-large", "KG/M3", &d.density[LARGE], 1e5, "of the second species [kg/m3]"),
        option_positive("radius", "MM", &radius, 1e5, "of the drum [mm]"),
        option_positive("width", "MM", &width, 1e5, "of the drum [mm]"),
        option_positive("speed", "RAD/S", &d.speed, 1e3, "of the drum [rad/s]"),
        option_positive("turns", "N", &d.turns, 1e4, "of the drum [-]"),
        option_double("fill", "X", &d.fill, 0.05, 0.6, "share of the drum that the bed fills [-]"),
        option_positive("stiffness", "N/M", &d.stiffness, 1e9, "of contacts, linear law [N/m]"),
        option_double("friction", "MU", &d.friction, 0.0, 10.0, "coefficient of friction, walls too [-]"),
        option_double("rolling", "M", &d.rolling, 0.0, 1.0, "lever arm of rolling resistance [m]"),
        option_positive("scale", "X", &scale, 1.0, "dosta: share of the numbers and of the width [-]"),
        option_positive("time", "S", &time, 1e4, "dosta: time that the drum turns, 5 in the paper [s]"),
        option_flag("movie", &film, "rotating_drum.mp4, by ffmpeg"),
        option_flag("animation", &page, "rotating_drum_turning.png, an animated PNG; a small one with --size 480x320"),
        option_size("size", view.size, "of the picture and the movie [pixels]"),
        option_string(
            "from", "FILE", &from,
            "begin with the spheres of a table, CSV or .vtp (a frame of this program); group 0: the small ones"),
    };
    program self =
        program_start("rotating_drum", "Two species of spheres in a turning drum: segregation and angle of repose.",
                      options, sizeof options / sizeof *options, argc, argv);
    d.diameter[SMALL] = 1e-3 * small, d.diameter[LARGE] = 1e-3 * large, d.radius = 1e-3 * radius,
    d.width = 1e-3 * width;
    if (self.quick && !is_given(&self, "turns")) d.turns = 0.2;
    if (self.quick && !is_given(&self, "width")) d.width = 0.012;
    if (self.quick && !is_given(&self, "time")) time = 0.01;
    if (d.dosta) choose_dosta(&d, scale, time);
    else count_by_fill(&d, &self);
    if (from) read_spheres(&d, &self, from, &given);
    check(&d, &self, from);

    static curves c;
    dem_world world;
    progress bar;
    int wall = 0;
    memset(&world, 0, sizeof world);
    progress_begin(&bar, "turning", 1.0);
    dem_status status = build(&world, &d, &wall);
    if (status == DEM_OK) status = from ? take(&world, &d, &given) : fill(&world, &d, self.seed, &bar, 0.2);
    particles_free(&given);
    if (status == DEM_BAD_ARGUMENT && !from)
        program_refuse(&self, "fill", NULL, "so much that the spheres find a place");
    if (status == DEM_OK) status = turn(&world, &d, wall, &self, film, page, &bar, &c);
    progress_end(&bar);
    if (status != DEM_OK) common_fail("%s", dem_status_text(status));
    if (common_exit_status() == 0) report(&self, &d, &world, &c);
    dem_free(&world);
    return common_exit_status();
}
