/* dem.h: what a particle-step costs as the number of spheres and the range of their sizes grow.

   Gas: spheres lie at random in a periodic box, 0.3 of it solid, fly about at 0.2 m/s on average and hit each other
   without loss, so that a run finds the same at any time; friction is computed, and is zero. The smallest are 1 mm.
   Sizes: equal, or diameters spread evenly between the smallest and the largest, by number (as many of each) or by mass
   (most are small). Bed: the settled bed of 20 000 spheres of dem_beds at rest, n x n times side by side, 4.9 contacts
   a sphere. A step is 1/20 of the duration of the smallest spheres' contacts.
   Figure of merit: processor time per particle-step over that of 20 000 equal spheres in the same state, which are
   timed just before; the median of repeats. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "dem.h"
#include "measure.h"

enum { POINTS_MAX = 24, REPEATS_MAX = 9, BASE = 20000, CHUNK = 50 };
static const double smallest = 1e-3, speed = 0.2, solid = 0.3;

typedef struct point {
    int spheres, by_mass, bed, steps; /* bed: copies along x and y; 0: gas */
    double ratio, step_s, over_base, fill_s, contacts, looks, steps_a_list, bytes;
} point;

/* 20 000 equal spheres when the clock starts: a saved world. */
typedef struct base {
    unsigned char *bytes;
    size_t size;
} base;

/* A box that holds so many spheres of a distribution at the solid share wanted, filled. */
static dem_status fill(dem_world *world, const point *p, uint64_t seed, memory *used) {
    dem_def def = dem_default_def();
    dem_feed feed = dem_default_feed();
    double volume = 0.0;
    const int material = dem_add_material(&def, 2500.0, 1e8, 0.2);
    feed.sizes = dem_uniform_sizes(smallest, p->ratio * smallest, p->by_mass);
    feed.random = seed;
    feed.scatter = dem_vec3(speed, speed, speed);
    for (int k = 0; k < p->spheres; k++) {
        const double d = dem_draw_size(&feed.sizes, &seed);
        volume += RIDDLE_PI / 6.0 * d * d * d;
    }
    const double side = riddle_cbrt(volume / solid);
    dem_pair(&def, material, material)->stiffness = 1e3;
    dem_pair(&def, material, material)->restitution = 1.0;
    dem_pair(&def, material, material)->friction = 0.0;
    def.gravity = dem_vec3(0.0, 0.0, 0.0);
    def.high = dem_vec3(side, side, side);
    for (int a = 0; a < 3; a++) def.periodic[a] = 1;
    def.allocator.fn = counted;
    def.allocator.user = used;
    feed.region = dem_box_region(def.low, def.high);
    dem_status status = dem_init(world, &def, NULL);
    if (status == DEM_OK) status = dem_fill(world, &feed, p->spheres);
    if (status == DEM_OK) status = dem_set_time_step(world, dem_advise(world, DEM_LINEAR, 1.0).contact / 20.0);
    return status;
}

/* The bed of 20 000, copied. */
static dem_status lay(dem_world *world, const point *p, memory *used) {
    dem_def def = dem_default_def();
    char path[1000], message[400];
    csv_data data;
    const int material = dem_add_material(&def, 2534.0, 1e8, 0.2);
    const double side = 0.14, diameter = 5e-3;
    dem_pair(&def, material, material)->restitution = 0.78;
    def.periodic[0] = def.periodic[1] = 1;
    def.high = dem_vec3(p->bed * side, p->bed * side, 1.0);
    def.allocator.fn = counted;
    def.allocator.user = used;
    dem_status status = dem_init(world, &def, NULL);
    if (csv_read(output_find(path, sizeof path, "tests/reference/beds/settled_20000.csv"), &data, message,
                 sizeof message) != 0) {
        common_fail("%s", message);
        return DEM_BAD_DATA;
    }
    if (status == DEM_OK && dem_add_plane(world, material, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) < 0)
        status = DEM_TOO_MANY;
    for (int copy = 0; copy < p->bed * p->bed; copy++) {
        for (int row = 0; row < data.rows && status == DEM_OK; row++) {
            const double centre[3] = {csv_value(&data, row, "x") + copy % p->bed * side,
                                      csv_value(&data, row, "y") + copy / p->bed * side, csv_value(&data, row, "z")};
            status = dem_add_spheres(world, 1, centre, &diameter, material, 0);
        }
    }
    csv_free(&data);
    if (status == DEM_OK) status = dem_set_time_step(world, dem_advise(world, DEM_LINEAR, 1.0).contact / 20.0);
    return status;
}

/* Steps before the clock starts: arrays grow, and copies, made without the history of their contacts, come to rest. */
static int warm_up(const program *self) { return self->quick ? CHUNK : 6 * CHUNK; }

/* So many steps: processor time of a particle-step [s]. */
static double fly(dem_world *world, int steps, progress *bar, dem_status *status) {
    const double begun = machine_processor_seconds();
    const int64_t before = world->particle_steps;
    for (int done = 0; done < steps && *status == DEM_OK && !common_interrupted(); done += CHUNK) {
        *status = dem_run(world, CHUNK * world->def.dt, DEM_LINEAR | DEM_FRICTION);
        progress_add(bar, (double)CHUNK * (double)world->count);
    }
    return (machine_processor_seconds() - begun) / (double)(world->particle_steps - before + 1);
}

static dem_status keep(base *b, const dem_world *world) {
    b->size = dem_save(world, NULL, 0);
    b->bytes = malloc(b->size);
    if (!b->bytes) return DEM_OUT_OF_MEMORY;
    dem_save(world, b->bytes, b->size);
    return DEM_OK;
}

/* The same for the base, from where it was kept. */
static double fly_base(const base *b, int before, int steps, progress *bar, dem_status *status) {
    dem_world world;
    if (*status == DEM_OK) *status = dem_load(&world, b->bytes, b->size, NULL);
    if (*status != DEM_OK) return (double)NAN;
    fly(&world, before, bar, status); /* arrays are made, and lists as long as they are to be */
    const double step_s = fly(&world, steps, bar, status);
    dem_free(&world);
    return step_s;
}

static int measure(point *p, base *b, int base_steps, int repeats, const program *self, progress *bar) {
    double times[REPEATS_MAX] = {0.0}, over[REPEATS_MAX] = {0.0};
    memory used = {0.0, 0.0};
    dem_world world;
    memset(&world, 0, sizeof world);
    p->fill_s = machine_processor_seconds();
    dem_status status = p->bed ? lay(&world, p, &used) : fill(&world, p, self->seed, &used);
    p->fill_s = machine_processor_seconds() - p->fill_s;
    fly(&world, warm_up(self), bar, &status);
    if (status == DEM_OK && !b->bytes) status = keep(b, &world);
    const int64_t steps0 = world.particle_steps, contacts0 = world.contact_steps, looks0 = world.looks,
                  lists0 = world.rebuilds;
    for (int k = 0; k < repeats && status == DEM_OK; k++) {
        const double alone = fly_base(b, warm_up(self), base_steps, bar, &status);
        times[k] = fly(&world, p->steps, bar, &status);
        over[k] = times[k] / alone;
    }
    if (status == DEM_OK) {
        const double steps = (double)(world.particle_steps - steps0);
        p->step_s = median(times, repeats);
        p->over_base = median(over, repeats);
        p->contacts = 2.0 * (double)(world.contact_steps - contacts0) / steps;
        p->looks = (double)(world.looks - looks0) / steps;
        p->steps_a_list = repeats * p->steps / fmax((double)(world.rebuilds - lists0), 1.0);
        p->bytes = used.most / (double)world.count;
        p->spheres = (int)world.count;
    }
    dem_free(&world);
    return status == DEM_OK ? 0 : common_fail("%d spheres, 1 : %g: %s", p->spheres, p->ratio, dem_status_text(status));
}

/* first: where the gases of equal spheres begin, those of sizes even by number, by mass. */
static void tell(const program *self, const point *points, int n, const int first[3]) {
    const int gases = first[0], by_number = first[1], by_mass = first[2];
    json *report = json_open(self->json);
    static const result_column columns[] = {{"state|", "state", "%s"},
                                            {"|bed"},
                                            {"spheres", "spheres", "%.0f"},
                                            {NULL, "sizes", "%s"},
                                            {"size_ratio"},
                                            {"by_mass", NULL, "yes|no"},
                                            {"|steps"},
                                            {"particle_step_s|step_s", "ns a particle-step", "%.0f", 1e9},
                                            {"over_base", "over 20 000 equal", "%.2f"},
                                            {"fill_s", "fill [s]", "%.2f"},
                                            {"|contacts", "contacts a sphere", "%.2f"},
                                            {"|looks", "looks a step", "%.2f"},
                                            {"|steps_a_list", "steps a list", "%.0f"},
                                            {"bytes_per_sphere|bytes_a_sphere", "bytes a sphere", "%.0f"}};
    result_table *t = RESULTS(columns);
    for (int k = 0; k < n; k++) {
        const point *p = &points[k];
        char text[60] = "equal";
        if (p->ratio != 1.0) snprintf(text, sizeof text, "1 : %g, by %s", p->ratio, p->by_mass ? "mass" : "number");
        results_row(t, TEXTS(p->bed ? "bed" : "gas", text), p->bed > 0, p->spheres, p->ratio, p->by_mass, p->steps,
                    p->step_s, p->over_base, p->fill_s, p->contacts, p->looks, p->steps_a_list, p->bytes);
    }
    results_write(t, report, "points", self->out, "dem_scaling.csv");
    const double *count = results_column(t, "spheres", 1.0), *sizes = results_column(t, "size_ratio", 1.0),
                 *over = results_column(t, "over_base", 1.0);
    riddle_plot *figure = riddle_plot_new("Cost of a particle-step, one core", 1, 2);
    riddle_plot_panel(figure, 0, 0, "number of equal spheres [-]", "over that of 20 000 equal spheres [-]");
    riddle_plot_log_x(figure);
    riddle_plot_range_y(figure, 0.0, 3.0);
    riddle_plot_horizontal(figure, "aim: at most 1.5", 1.5);
    riddle_plot_line(figure, "bed at rest", count, over, gases);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_line(figure, "gas", count + gases, over + gases, by_number - gases);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_panel(figure, 0, 1, "largest over smallest diameter [-]", "over that of 20 000 equal spheres [-]");
    riddle_plot_log_x(figure);
    riddle_plot_range_y(figure, 0.0, 3.0);
    riddle_plot_horizontal(figure, "aim: at most 1.5", 1.5);
    riddle_plot_line(figure, "diameters even by number", sizes + by_number, over + by_number, by_mass - by_number);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_line(figure, "diameters even by mass", sizes + by_mass, over + by_mass, n - by_mass);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_write(figure, self->out, "dem_scaling.svg");
    results_free(t);
    json_program(report, self);
    json_close(report);
}

int main(int argc, char **argv) {
    int most = 1000000, steps = 1000, repeats = 3;
    double ratio = 20.0;
    option options[] = {
        option_int("spheres", "N", &most, BASE, 20000000, "largest number of spheres"),
        option_double("ratio", "X", &ratio, 1.0, 100.0, "largest over smallest diameter [-]"),
        option_int("steps", "N", &steps, 50, 1000000, "time steps of 20 000 spheres; more spheres take fewer"),
        option_int("repeats", "N", &repeats, 1, REPEATS_MAX, "runs of each; the median is told"),
    };
    program self = program_start("dem_scaling",
                                 "dem.h: cost of a particle-step over the number of spheres and the range of sizes.",
                                 options, sizeof options / sizeof *options, argc, argv);
    if (self.quick && !is_given(&self, "spheres")) most = BASE;
    program_need_spheres(&self, "spheres", most);
    if (self.quick && !is_given(&self, "steps")) steps = 100, repeats = is_given(&self, "repeats") ? repeats : 1;
    static const int copies[] = {1, 2, 4, 7, 14, 28}; /* 20 000, 80 000, 320 000, 980 000 .. */
    point points[POINTS_MAX];
    int n = 0, first[3] = {0, 0, 0};
    double work = 0.0;
    memset(points, 0, sizeof points);
    for (int gas = 0; gas < 2; gas++) {
        for (int k = 0; k < 6 && copies[k] * copies[k] * BASE <= most; k++) {
            points[n].spheres = copies[k] * copies[k] * BASE;
            points[n].bed = gas ? 0 : copies[k];
            points[n++].ratio = 1.0;
        }
        first[gas] = n;
    }
    for (int mass = 0; mass < 2; mass++) {
        if (mass) first[2] = n;
        for (double r = 1.0; r <= ratio; r = r < ratio ? fmin(r < 5.0 ? 2.5 * r : 2.0 * r, ratio) : 2.0 * ratio) {
            points[n].spheres = BASE;
            points[n].by_mass = mass;
            points[n++].ratio = r;
        }
    }
    for (int k = 0; k < n; k++) {
        /* a gas is cheap, and makes a list every hundred steps */
        const double undivided = (points[k].bed ? 5.0 : 15.0) * BASE;
        points[k].steps = (int)fmax(50.0, steps / fmax(1.0, points[k].spheres / undivided)) / 50 * 50;
        work += (double)(points[k].steps * repeats + warm_up(&self)) * points[k].spheres +
                (double)repeats * (steps + warm_up(&self)) * BASE;
    }
    base bases[2] = {{NULL, 0}, {NULL, 0}};
    progress bar;
    progress_begin(&bar, "flying", work);
    for (int k = 0; k < n && !common_interrupted(); k++) {
        if (measure(&points[k], &bases[points[k].bed > 0], (int)fmax(CHUNK, steps / CHUNK * CHUNK), repeats, &self,
                    &bar) != 0)
            break;
    }
    for (int k = 0; k < 2; k++) free(bases[k].bytes);
    if (common_interrupted()) progress_end(&bar);
    if (common_exit_status() != 0) return common_exit_status();
    progress_end(&bar);

    tell(&self, points, n, first);
    return common_exit_status();
}
