/* dem.h: cost of a wall of triangles: to build, in memory, and per contact and step, compared with a plane.

   Spheres of 5 mm roll side by side over a floor that is a plane, or a plate of 0.5 m of more and more triangles, cut
   along random diagonals. All are in contact in every step, which is the worst case: a sphere without contact is tested
   only when it could touch. With 400 spheres and a fine mesh the data fill the caches; with 9 spheres they do not, and
   the depth of the tree determines the time. Figure of merit: processor time of a step of a sphere, the median of
   repeats, over that of as many on the plane. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "dem.h"
#include "measure.h"

enum { POINTS_MAX = 20, REPEATS_MAX = 9 };
static const double diameter = 5e-3, side = 0.5, spacing = 0.02;
static const int rows[2] = {20, 3}; /* of spheres */

typedef struct point {
    int few, across, triangles; /* few: 9 spheres; cells along a side, 0: the plane */
    double step_s, build_s, bytes, height;
} point;

/* Square cells, each cut along either diagonal. */
static dem_mesh plate(int across, uint64_t random) {
    dem_mesh m;
    memset(&m, 0, sizeof m);
    m.vertex = malloc((size_t)(across + 1) * (size_t)(across + 1) * 3 * sizeof *m.vertex);
    m.triangle = malloc((size_t)across * (size_t)across * 6 * sizeof *m.triangle);
    for (int k = 0; k < (across + 1) * (across + 1) && m.vertex; k++) {
        double *x = &m.vertex[3 * m.vertices++];
        x[0] = (k % (across + 1) / (double)across - 0.5) * side,
        x[1] = (k / (across + 1) / (double)across - 0.5) * side, x[2] = 0.0;
    }
    for (int k = 0; k < across * across && m.triangle; k++) {
        const int32_t a = k / across * (across + 1) + k % across, b = a + 1, c = a + across + 1, d = c + 1;
        random = random * 6364136223846793005u + 1442695040888963407u;
        const int32_t corners[2][6] = {{a, b, d, a, d, c}, {a, b, c, b, d, c}};
        memcpy(&m.triangle[3 * m.triangles], corners[random >> 63], sizeof corners[0]);
        m.triangles += 2;
    }
    return m;
}

static dem_status lay_floor(dem_world *world, point *p, uint64_t seed, memory *used) {
    if (p->across == 0)
        return dem_add_plane(world, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) < 0 ? DEM_TOO_MANY : DEM_OK;
    dem_mesh mesh = plate(p->across, seed);
    if (!mesh.vertex || !mesh.triangle) mesh.triangles = 0;
    const double before = used->now, begun = machine_processor_seconds();
    const int wall = dem_add_mesh(world, 0, &mesh);
    p->build_s = machine_processor_seconds() - begun;
    p->bytes = (used->now - before) / p->triangles;
    free(mesh.vertex), free(mesh.triangle);
    return wall < 0 ? (dem_status)-wall : DEM_OK;
}

/* Few take ten times as many steps. */
static int measure(point *p, int steps_of_all, int repeats, const program *self, progress *bar) {
    const int across = rows[p->few], n = across * across, steps = p->few ? 10 * steps_of_all : steps_of_all;
    double times[REPEATS_MAX];
    memory used = {0.0, 0.0};
    dem_world world;
    dem_def def = dem_default_def();
    const int material = dem_add_material(&def, 2500.0, 1e8, 0.2);
    const double overlap = 2500.0 * RIDDLE_PI / 6.0 * diameter * diameter * diameter * 9.81 /
                           dem_pair(&def, material, material)->stiffness;
    def.allocator.fn = counted;
    def.allocator.user = &used;
    memset(&world, 0, sizeof world);
    dem_status status = dem_init(&world, &def, NULL);
    p->triangles = 2 * p->across * p->across;
    if (status == DEM_OK) status = lay_floor(&world, p, self->seed, &used);
    for (int k = 0; k < n && status == DEM_OK; k++) {
        const double at[3] = {(k % across - 0.5 * across) * spacing, (k / across - 0.5 * across) * spacing,
                              0.5 * diameter - overlap};
        status = dem_add_spheres(&world, 1, at, &diameter, material, 0);
        /* rolls */
        if (status == DEM_OK) status = dem_set_motion(&world, k, dem_vec3(0.3, 0.2, 0), dem_vec3(-80, 120, 0));
    }
    if (status == DEM_OK) status = dem_set_time_step(&world, dem_advise(&world, DEM_LINEAR, 1.0).contact / 20.0);
    for (int k = -1; k < repeats && status == DEM_OK && !common_interrupted(); k++) { /* once to warm up */
        const double begun = machine_processor_seconds();
        status = dem_run(&world, steps * world.def.dt, DEM_LINEAR | DEM_FRICTION);
        if (k >= 0) times[k] = (machine_processor_seconds() - begun) / ((double)steps * n);
        progress_add(bar, 1.0);
    }
    if (status == DEM_OK) {
        p->step_s = median(times, repeats);
        for (int k = 0; k < n; k++) p->height += dem_position(&world, k).z / n;
    }
    dem_free(&world);
    if (status == DEM_OK && !common_interrupted() && !(p->height > 0.4 * diameter))
        return common_fail("spheres have left the plate: fewer --steps are needed");
    return status == DEM_OK ? 0 : common_fail("%d triangles: %s", p->triangles, dem_status_text(status));
}

int main(int argc, char **argv) {
    int most = 1000000, steps = 2000, repeats = 5;
    option options[] = {
        option_int("triangles", "N", &most, 100, 10000000, "largest number of triangles"),
        option_int("steps", "N", &steps, 10, 100000, "time steps of a repeat"),
        option_int("repeats", "N", &repeats, 1, REPEATS_MAX, "runs of each; the median is told"),
    };
    program self = program_start("dem_mesh", "dem.h: cost of a wall of triangles over their number.", options,
                                 sizeof options / sizeof *options, argc, argv);
    if (self.quick && !is_given(&self, "triangles")) most = 100000;
    if (self.quick && !is_given(&self, "steps")) steps = 200;
    point points[POINTS_MAX];
    int n = 0, many = 0; /* many: points of 400 spheres */
    memset(points, 0, sizeof points);
    for (int few = 0; few < 2; few++) {
        points[n++].few = few;
        for (double triangles = 1e2; triangles <= most && n < POINTS_MAX; triangles *= 10.0) {
            points[n].across = (int)ceil(sqrt(0.5 * triangles) - 1e-9);
            points[n++].few = few;
        }
        if (!few) many = n;
    }
    progress bar;
    progress_begin(&bar, "rolling", (double)n * (repeats + 1));
    for (int k = 0; k < n && !common_interrupted(); k++) {
        if (measure(&points[k], steps, repeats, &self, &bar) != 0) return common_exit_status();
    }
    progress_end(&bar);
    if (common_interrupted()) return common_exit_status();

    json *report = json_open(self.json);
    static const result_column columns[] = {{NULL, "floor", "%s"},
                                            {"triangles", "triangles", "%.0f"},
                                            {"spheres", "spheres", "%.0f"},
                                            {"step_s", "ns a step of a sphere", "%.0f", 1e9},
                                            {"over_plane", "over the plane", "%.2f"},
                                            {"build_s", "build [ms]", "%.3g", 1e3},
                                            {"bytes_per_triangle|bytes_a_triangle", "bytes a triangle", "%.0f"},
                                            {"mean_height_m|"}};
    result_table *t = RESULTS(columns);
    for (int k = 0; k < n; k++) {
        const point *p = &points[k];
        results_row(t, TEXTS(p->across == 0 ? "plane" : "triangles"), p->triangles, rows[p->few] * rows[p->few],
                    p->step_s, p->step_s / points[p->few ? many : 0].step_s, p->build_s, p->bytes, p->height);
    }
    results_write(t, report, "points", self.out, "dem_mesh.csv");
    const double *count = results_column(t, "triangles", 1.0), *over = results_column(t, "over_plane", 1.0);
    riddle_plot *figure = riddle_plot_new(
        "A wall of triangles, one core; 112 bytes each: the last tree, 110 MB, exceeds the cache", 1, 2);
    riddle_plot_panel(figure, 0, 0, "triangles [-]", "step over that on a plane [-]");
    riddle_plot_log_x(figure), riddle_plot_log_y(figure);
    riddle_plot_line(figure, "400 spheres, far apart", count + 1, over + 1, many - 1);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_line(figure, "9 spheres", count + many + 1, over + many + 1, n - many - 1);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_panel(figure, 0, 1, "triangles [-]", "dem_add_mesh: time [s]");
    riddle_plot_log_x(figure), riddle_plot_log_y(figure);
    riddle_plot_points(figure, NULL, count + 1, results_column(t, "build_s", 1.0) + 1, many - 1);
    riddle_plot_write(figure, self.out, "dem_mesh.svg");
    results_free(t);
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
