/* dem.h: cost of a container made of a mesh: the same bed at rest in five planes, in dem_add_box and in 56 triangles.

   Spheres of 3.6 to 4.4 mm settle in a box of 50 mm; then steps are timed. Figure of merit: processor time of a contact
   and step, the smallest of repeats in turns, over that in planes. 10 % of the contacts are with walls. */
#include <math.h>
#include <string.h>

#include "common.h"
#include "dem.h"

enum { KINDS = 3, FEATURES = DEM_LINEAR | DEM_FRICTION };
static const double side = 0.05, height = 0.4;
static const char *const name[KINDS] = {"five planes", "dem_add_box", "56 triangles"};

static int add_planes(dem_world *w) {
    const dem_vec point[5] = {{0, 0, 0}, {0, 0, 0}, {side, 0, 0}, {0, 0, 0}, {0, side, 0}};
    const dem_vec normal[5] = {{0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    int last = 0;
    for (int k = 0; k < 5; k++) last = dem_add_plane(w, 0, point[k], normal[k]);
    return last;
}

/* A floor of 2 by 2 squares and four walls of 2 by 3 rectangles, open above. */
static int add_triangles(dem_world *w) {
    double vertex[3 * (9 + 4 * 12)];
    int32_t triangle[3 * 56];
    dem_mesh m;
    memset(&m, 0, sizeof m);
    m.vertex = vertex, m.triangle = triangle;
    for (int f = 0; f < 5; f++) {
        const int rows = f ? 3 : 2;
        const int32_t first = (int32_t)m.vertices;
        for (int k = 0; k < 3 * (rows + 1); k++) {
            const double p = 0.5 * side * (k % 3), q = (f ? height : side) * (k / 3) / rows, far = f % 2 ? 0.0 : side;
            const double x[3] = {f == 1 || f == 2 ? far : p, f == 0 ? q : f < 3 ? p : far, f == 0 ? 0.0 : q};
            memcpy(&vertex[3 * m.vertices++], x, sizeof x);
        }
        for (int k = 0; k < 2 * rows; k++) {
            const int32_t o = first + 3 * (k / 2) + k % 2, six[6] = {o, o + 1, o + 4, o, o + 4, o + 3};
            memcpy(&triangle[3 * m.triangles], six, sizeof six);
            m.triangles += 2;
        }
    }
    return dem_add_mesh(w, 0, &m);
}

static dem_status settle(dem_world *w, int kind, int spheres, double time, uint64_t seed) {
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 2500.0, 1e8, 0.2);
    dem_pair_def *pair = dem_pair(&def, m, m);
    pair->stiffness = 1e4, pair->restitution = 0.5;
    def.dt = 1e-5;
    dem_status status = dem_init(w, &def, NULL);
    if (status != DEM_OK) return status;
    const int wall = kind == 0   ? add_planes(w)
                     : kind == 1 ? dem_add_box(w, m, dem_vec3(0, 0, 0), dem_vec3(side, side, height))
                                 : add_triangles(w);
    if (wall < 0) return (dem_status)-wall;
    dem_feed feed = dem_default_feed();
    feed.sizes = dem_uniform_sizes(0.0036, 0.0044, 0), feed.random = seed, feed.tries = 100;
    feed.region = dem_box_region(dem_vec3(1e-4, 1e-4, 1e-4), dem_vec3(side - 1e-4, side - 1e-4, height - 1e-3));
    status = dem_fill(w, &feed, spheres);
    for (int k = 0; k < 100 && status == DEM_OK && !common_interrupted(); k++)
        status = dem_run(w, 0.01 * time, FEATURES);
    return status;
}

int main(int argc, char **argv) {
    int spheres = 2000, steps = 2000, repeats = 5;
    option options[] = {
        option_int("spheres", "N", &spheres, 10, 5000, "spheres in the bed"),
        option_int("steps", "N", &steps, 10, 100000, "time steps of a repeat"),
        option_int("repeats", "N", &repeats, 1, 100, "runs of each; the fastest is told"),
    };
    program self = program_start("dem_container", "dem.h: a bed at rest in planes, a box and triangles.", options,
                                 sizeof options / sizeof *options, argc, argv);
    if (self.quick && !is_given(&self, "spheres")) spheres = 200;
    if (self.quick && !is_given(&self, "steps")) steps = 200;
    dem_world world[KINDS];
    double best[KINDS];
    dem_status status = DEM_OK;
    memset(world, 0, sizeof world);
    for (int k = 0; k < KINDS && status == DEM_OK; k++) {
        best[k] = HUGE_VAL;
        status = settle(&world[k], k, spheres, self.quick ? 0.25 : 0.45, self.seed);
    }
    for (int r = 0; r < repeats * KINDS && status == DEM_OK && !common_interrupted(); r++) {
        dem_world *w = &world[r % KINDS];
        const int64_t before = w->contact_steps;
        const double began = machine_processor_seconds();
        status = dem_run(w, steps * w->def.dt, FEATURES);
        best[r % KINDS] = fmin(best[r % KINDS],
                               (machine_processor_seconds() - began) / fmax((double)(w->contact_steps - before), 1.0));
    }
    if (status != DEM_OK) common_fail("%s", dem_status_text(status));
    if (common_exit_status() == 0) {
        json *report = json_open(self.json);
        static const result_column columns[] = {{"container", "container", "%s"},
                                                {"contact_step_s", "ns a contact and step", "%.1f", 1e9},
                                                {"over_planes", "over planes", "%.2f"},
                                                {"|contacts", "contacts", "%.0f"}};
        result_table *t = RESULTS(columns);
        for (int k = 0; k < KINDS; k++)
            results_row(t, TEXTS(name[k]), best[k], best[k] / best[0], (double)dem_contact_count(&world[k]));
        results_write(t, report, "containers", self.out, "dem_container.csv");
        const double number[KINDS] = {1, 2, 3};
        riddle_plot *figure = riddle_plot_new("A bed at rest, one core", 1, 1);
        riddle_plot_panel(figure, 0, 0, "1 five planes, 2 dem_add_box, 3 triangles",
                          "time of a contact and step over planes [-]");
        riddle_plot_points(figure, NULL, number, results_column(t, "over_planes", 1.0), KINDS);
        riddle_plot_write(figure, self.out, "dem_container.svg");
        results_free(t);
        json_program(report, &self);
        json_close(report);
    }
    for (int k = 0; k < KINDS; k++) dem_free(&world[k]);
    return common_exit_status();
}
