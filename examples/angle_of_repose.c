/* angle_of_repose - spheres through a funnel onto a plate: the slope of the heap against the coefficient of friction.

   The funnel is a triangle mesh from an STL file: the program writes one, or --stl names yours. Spheres of one size are
   fed into its top. Below it is a round plate with a rim one diameter high, over which the surplus falls. The surface
   of the heap at rest is the highest centre in each ring and sector of the plate; the angle of repose is the slope of a
   line through the means of the rings. Its error is the standard error of the mean of several heaps with other random
   numbers. The funnel rises with the tip of a heap that grows to it; where a heap does not come to rest, has too few
   spheres, or the funnel is blocked, there is no angle, and the program says why. Friction acts between spheres and
   with the plate; the funnel is smooth. Rolling resistance with a lever arm replaces the shape that spheres lack. For
   your own heap: the options and your funnel. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "dem.h"
#include "heap_slope.h"
#include "world_picture.h"

enum {
    RINGS = HEAP_RINGS,
    CASES = 5,
    HEAPS_MAX = 50,
    AROUND = 48,
    RAISES_MAX = 4,
    FEATURES = DEM_LINEAR | DEM_FRICTION | DEM_ROLLING
};

static picture_def view = {{NULL}, 0, 0.0, {0.25, 1.0, -0.2}, {960, 640}};

typedef struct heap {
    /* asked for */
    double diameter, friction, rolling; /* [m], [-], lever arm over diameter [-] */
    int spheres;
    uint64_t seed;
    const dem_mesh *funnel;
    const char *folder; /* of the series and pictures, or NULL */
    bool film;
    progress *bar;
    double outlet; /* height of the funnel's outlet over the plate [m]; raised where the heap touches it */
    /* found */
    dem_status status;
    double angle;    /* slope [rad]; NaN: there is none */
    const char *why; /* there is none; NULL */
    double radius[RINGS],
        height[RINGS];       /* of rings, and of centres over the plate [m]; NaN where hardly any sector has one */
    double speed, time;      /* largest at the end [m/s], simulated [s] */
    int on_plate, in_funnel; /* spheres */
    bool raised;             /* the funnel was */
} heap;

/* A surface of revolution: points (radius, height), from the outlet up. Free its arrays. */
static dem_mesh lathe(const double (*point)[2], int n) {
    dem_mesh m;
    memset(&m, 0, sizeof m);
    m.vertex = malloc((size_t)(3 * n * AROUND) * sizeof *m.vertex);
    m.triangle = malloc((size_t)(6 * n * AROUND) * sizeof *m.triangle);
    for (int k = 0; m.vertex && m.triangle && k < n * AROUND; k++) {
        const double *p = point[k / AROUND], angle = 2.0 * RIDDLE_PI * (k % AROUND) / AROUND;
        double *x = &m.vertex[3 * m.vertices++];
        x[0] = p[0] * cos(angle), x[1] = p[0] * sin(angle), x[2] = p[1];
        if (k / AROUND == n - 1) continue;
        const int32_t a = k, b = k / AROUND * AROUND + (k + 1) % AROUND, c = a + AROUND, d = b + AROUND;
        const int32_t corners[6] = {a, b, d, a, d, c};
        memcpy(&m.triangle[3 * m.triangles], corners, sizeof corners);
        m.triangles += 2;
    }
    return m;
}

/* Millimetres, as most programs write them. */
static int write_stl(const char *folder, const char *name, const dem_mesh *m) {
    riddle_io_file *file = riddle_io_open(folder, name);
    riddle_io_print(file, "solid funnel\n");
    for (ptrdiff_t k = 0; k < m->triangles; k++) {
        riddle_io_print(file, "facet normal 0 0 0\n outer loop\n");
        for (int c = 0; c < 3; c++) {
            const double *x = &m->vertex[3 * m->triangle[3 * k + c]];
            riddle_io_print(file, "  vertex %.9g %.9g %.9g\n", 1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
        }
        riddle_io_print(file, " endloop\nendfacet\n");
    }
    riddle_io_print(file, "endsolid funnel\n");
    return (int)riddle_io_close(file);
}

static void corners_of(const dem_mesh *m, dem_vec *low, dem_vec *high) {
    *low = dem_vec3(HUGE_VAL, HUGE_VAL, HUGE_VAL), *high = dem_vec3(-HUGE_VAL, -HUGE_VAL, -HUGE_VAL);
    for (ptrdiff_t k = 0; k < 3 * m->vertices; k++) {
        double *l = dem_axis_of(low, (int)(k % 3)), *h = dem_axis_of(high, (int)(k % 3));
        *l = fmin(*l, m->vertex[k]), *h = fmax(*h, m->vertex[k]);
    }
}

static double speed_of(const dem_world *w, ptrdiff_t i) {
    const dem_vec v = dem_velocity(w, i);
    return sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

/* Spheres on the plate and above the outlet, and the largest speed of those on the plate. The highest of these that
   does not fall, or with supported has two neighbours [m]. */
static double take_stock(heap *h, const dem_world *w, dem_vec centre, double plate, bool supported) {
    const double falls = 0.2 * sqrt(9.81 * h->diameter);
    double top = 0.0;
    h->on_plate = h->in_funnel = 0, h->speed = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_vec p = dem_position(w, i);
        const double up = p.z - centre.z, speed = speed_of(w, i);
        if (!w->alive[i]) continue;
        if (up >= h->outlet) {
            h->in_funnel++;
            continue;
        }
        if (!(hypot(p.x - centre.x, p.y - centre.y) < plate && up >= 0.0)) continue;
        h->on_plate++;
        h->speed = fmax(h->speed, speed);
        if (speed < falls && (!supported || w->touching[i] > 1)) top = fmax(top, up);
    }
    return top;
}

/* The slope of what lies below the outlet. Returns how many rings the line has. */
static int measure(heap *h, const dem_world *w, dem_vec centre, double plate) {
    const heap_slope found = heap_slope_of(w, centre, dem_vec3(0, 0, 1), plate, h->outlet);
    memcpy(h->radius, found.radius, sizeof h->radius);
    memcpy(h->height, found.height, sizeof h->height);
    h->angle = found.angle;
    return found.rings;
}

/* Is the largest speed on the plate below that of a fall through a thousandth of a diameter? */
static bool is_at_rest(const heap *h) { return h->speed < sqrt(2e-3 * 9.81 * h->diameter); }

/* The angle, or why there is none: what stands in the funnel on top of the heap, for one, is no slope. */
static void judge(heap *h, const dem_world *w, dem_vec centre, double plate) {
    static const char *const reasons[] = {"the heap touches the funnel", "the funnel is blocked",
                                          "the heap does not come to rest", "too few spheres stay on the plate"};
    const double top = take_stock(h, w, centre, plate, false);
    const bool touches = top > h->outlet - 0.75 * h->diameter;
    const int rings = measure(h, w, centre, plate);
    h->why = touches                          ? reasons[0]
             : h->in_funnel > 0               ? reasons[1]
             : !is_at_rest(h)                 ? reasons[2]
             : rings < 4 || h->on_plate < 100 ? reasons[3]
                                              : NULL;
    if (h->why) h->angle = (double)NAN;
}

/* Lets the funnel rise while the tip of the heap is within a diameter of its outlet. */
static dem_status follow_tip(heap *h, dem_world *w, int funnel, dem_vec centre, double plate, double interval,
                             dem_region *mouth) {
    const double rise = take_stock(h, w, centre, plate, true) > h->outlet - h->diameter ? h->diameter : 0.0;
    if (rise == 0.0 && !h->raised) return DEM_OK;
    h->outlet += rise, h->raised = true;
    mouth->low.z += rise;
    return dem_move(w, funnel, dem_vec3(0, 0, rise / interval));
}

/* Pours one heap and measures it. */
static void pour(heap *h) {
    const double d = h->diameter, plate = cbrt(0.57 * h->spheres) * d; /* what stays on it is about half */
    dem_vec low, high;
    dem_world world;
    dem_def def = dem_default_def();
    def.allocator.fn = machine_resize;
    const int sphere = dem_add_material(&def, 2500.0, 1e8, 0.25), smooth = dem_add_material(&def, 2500.0, 1e8, 0.25);
    dem_pair_def *pair = dem_pair(&def, sphere, sphere);
    const double weight = 2500.0 * RIDDLE_PI / 6.0 * d * d * d * 9.81;
    pair->stiffness = 2e4 * weight / d; /* ten layers press their lowest spheres in by 5e-4 of the diameter */
    pair->restitution = 0.5, pair->friction = h->friction, pair->rolling = h->rolling * d,
    pair->tangential_damping = 0.3;
    *dem_pair(&def, sphere, smooth) = *pair;
    dem_pair(&def, sphere, smooth)->friction = fmin(0.2, h->friction);
    h->status = dem_init(&world, &def, NULL);
    if (h->status != DEM_OK) return;
    corners_of(h->funnel, &low, &high);
    const dem_vec centre = dem_vec3(0.5 * (low.x + high.x), 0.5 * (low.y + high.y), low.z - h->outlet);
    dem_cone rim = dem_default_cone();
    rim.low = rim.high = centre, rim.high.z += d;
    rim.low_radius = rim.high_radius = plate;
    const int walls[3] = {dem_add_mesh(&world, smooth, h->funnel), dem_add_cone(&world, sphere, &rim),
                          dem_add_plane(&world, sphere, centre, dem_vec3(0, 0, 1))};
    for (int k = 0; k < 3 && h->status == DEM_OK; k++) h->status = walls[k] < 0 ? (dem_status)-walls[k] : DEM_OK;

    dem_feed feed = dem_default_feed();
    const double mouth = 0.3 * fmin(high.x - low.x, high.y - low.y);
    feed.region = dem_cylinder_region(dem_vec3(centre.x, centre.y, high.z), dem_vec3(0, 0, 1), 4.0 * d, mouth);
    feed.sizes = dem_one_size(d), feed.material = sphere, feed.random = h->seed;
    feed.velocity = dem_vec3(0, 0, -sqrt(9.81 * d)),
    feed.scatter = dem_vec3(0.1 * sqrt(9.81 * d), 0.1 * sqrt(9.81 * d), 0);
    const double unit = sqrt(d / 9.81), interval = 2.0 * unit,
                 rate = 10.0 / unit; /* the outlet lets through about 20 spheres a unit */
    double end = h->spheres / rate + 45.0 * unit;
    const double latest = end + 200.0 * unit;
    dem_io_series series = {0};
    if (h->folder) series = dem_io_open(h->folder, "particles");
    world_movie reel = {0};
    if (h->folder && h->film) reel = world_movie_open(h->folder, "angle_of_repose.mp4", &view);
    for (int step = 0; world.time < end && h->status == DEM_OK && !common_interrupted(); step++) {
        if (feed.placed < h->spheres) h->status = dem_feed_number(&world, &feed, rate, interval);
        if (step == 0 && h->status == DEM_OK)
            h->status = dem_set_time_step(&world, 2.0 * dem_advise(&world, FEATURES, 1.0).advised);
        if (series.particles && step % 5 == 0) dem_io_add(&series, &world);
        if (step > 0) world_movie_add(&reel, &world);
        if (h->status == DEM_OK) h->status = follow_tip(h, &world, walls[0], centre, plate, interval, &feed.region);
        if (h->status == DEM_OK) h->status = dem_run(&world, interval, FEATURES);
        for (ptrdiff_t i = world.count - 1; i >= 0; i--) { /* over the rim */
            const dem_vec p = dem_position(&world, i);
            if (world.alive[i] && hypot(p.x - centre.x, p.y - centre.y) > plate + d && p.z < low.z)
                dem_remove(&world, i);
        }
        progress_add(h->bar, fmin(interval / end, fmax(0.0, 1.0 - world.time / end)));
        if (world.time < end || end >= latest) continue;
        take_stock(h, &world, centre, plate, false); /* what still moves gets time to come to rest */
        if (!is_at_rest(h)) end = fmin(end + 20.0 * unit, latest);
    }
    if (h->folder && h->status == DEM_OK)
        dem_io_add(&series, &world), draw_world(&world, &view, h->folder, "angle_of_repose.png");
    if (h->folder) dem_io_close(&series);
    world_movie_close(&reel);
    h->time = world.time;
    if (h->status == DEM_OK) judge(h, &world, centre, plate);
    dem_free(&world);
}

static int pour_one(int index, void *user) {
    heap *h = (heap *)user + index;
    pour(h);
    return h->status != DEM_OK;
}

/* Heaps of one friction: the mean of their angles, and its standard error, NaN of one heap [rad]. The heights are those
   of the first. Returns how many heaps have an angle. */
static int average(const heap *h, int heaps, double *mean, double *error) {
    double sum = 0.0, square = 0.0;
    int n = 0;
    for (int k = 0; k < heaps; k++)
        if (!isnan(h[k].angle)) sum += h[k].angle, n++;
    *mean = n ? sum / n : (double)NAN;
    for (int k = 0; k < heaps; k++)
        if (!isnan(h[k].angle)) square += (h[k].angle - *mean) * (h[k].angle - *mean);
    *error = n > 1 ? sqrt(square / (n - 1.0) / n) : (double)NAN;
    return n;
}

/* Says which heaps have no angle, and which funnels were raised. */
static void explain(const heap *all, int n, int heaps) {
    for (int k = 0; k < n * heaps; k++) {
        const heap *h = &all[k];
        if (h->why)
            common_print("No angle of heap %d at friction %.3g: %s (%d spheres on the plate, %d above the outlet, "
                         "fastest %.2g mm/s).\n",
                         k % heaps + 1, h->friction, h->why, h->on_plate, h->in_funnel, 1e3 * h->speed);
        else if (h->raised)
            common_print("Heap %d at friction %.3g grew to the funnel, which rose to %.3g mm.\n", k % heaps + 1,
                         h->friction, 1e3 * h->outlet);
    }
}

static void report(const program *self, const heap *all, int n, int heaps, const dem_stl_report *stl) {
    const double degree = 180.0 / RIDDLE_PI;
    static const result_column columns[] = {{"friction", "friction [-]", "%.3g"},
                                            {"angle_deg", "angle of repose [deg]", "%.1f"},
                                            {"standard_error_deg", "its standard error [deg]", "%.1f"},
                                            {"heaps"},
                                            {"on_plate", "on the plate", "%.0f"},
                                            {"largest_speed_m_s", "largest speed [mm/s]", "%.2g", 1e3}};
    result_table *t = RESULTS(columns);
    riddle_plot *figure = riddle_plot_new("Heaps poured through a funnel", 1, n > 2 ? 2 : 1);
    riddle_plot_panel(figure, 0, 0, "distance from the axis [mm]", "height of the surface's centres [mm]");
    riddle_plot_equal(figure);
    for (int k = 0; k < n; k++) {
        const heap *h = &all[k * heaps];
        double x[RINGS], y[RINGS];
        char label[40];
        for (int q = 0; q < RINGS; q++) x[q] = 1e3 * h->radius[q], y[q] = 1e3 * h->height[q];
        snprintf(label, sizeof label, "friction %.3g", h->friction);
        riddle_plot_line(figure, label, x, y, RINGS);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
        double mean, of_mean;
        const int with_angle = average(h, heaps, &mean, &of_mean);
        results_row(t, NULL, h->friction, mean * degree, of_mean * degree, with_angle, h->on_plate, h->speed);
    }
    results_print(t);
    results_csv(t, self->out, "angle_of_repose.csv");
    const double *friction = results_column(t, "friction", 1.0), *angle = results_column(t, "angle_deg", 1.0),
                 *error = results_column(t, "standard_error_deg", 1.0);
    explain(all, n, heaps);
    if (heaps > 1)
        common_print(
            "Means of %d heaps each, with other random numbers; heights, numbers and speeds are of the first.\n",
            heaps);
    else common_print("One heap each: how far others would be from it is not known; --heaps tells.\n");
    if (n > 2) { /* two angles are no curve */
        riddle_plot_panel(figure, 0, 1, "coefficient of friction [-]", "angle of repose [°]");
        riddle_plot_line(figure, "slope of the surface", friction, angle, n);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED, 0);
        if (heaps > 1) riddle_plot_error_bars(figure, "standard error of the mean", friction, angle, error, n);
        if (heaps > 1) riddle_plot_style(figure, 0, RIDDLE_PLOT_SAME);
    }
    riddle_plot_write(figure, self->out, "angle_of_repose.svg");

    json *j = json_open(self->json);
    json_program(j, self);
    json_array(j, "friction", friction, n);
    json_array(j, "angle_of_repose_deg", angle, n);
    json_array(j, "standard_error_deg", error, n); /* null of one heap */
    results_values(j, {"heaps", heaps}, {"diameter_m", all[0].diameter},
                   {"rolling_lever_arm_m", all[0].rolling * all[0].diameter}, {"spheres", all[0].spheres},
                   {"simulated_s", all[0].time}, {"outlet_m", all[0].outlet});
    json_array_begin(j, "why_no_angle"); /* of each heap; null: it has one */
    for (int k = 0; k < n * heaps; k++) json_string(j, NULL, all[k].why);
    json_array_end(j);
    results_values(j, {"stl_facets", (double)stl->facets}, {"stl_open_edges", (double)stl->open_edges},
                   {"stl_wrong_normals", (double)stl->wrong_normals});
    json_bool(j, "deterministic_build", dem_build_is_deterministic());
    json_close(j);
    results_free(t);
}

int main(int argc, char **argv) {
    double diameter_mm = 5.0, one_friction = 0.5, rolling = 0.02, scale = 1e-3, outlet = 7.0;
    int spheres = 1000, repeats = 3;
    bool film = false;
    const char *stl = NULL;
    option options[] = {
        option_double("friction", "MU", &one_friction, 0.0, 5.0,
                      "one coefficient of friction [-] instead of a row of five"),
        option_double("rolling", "SHARE", &rolling, 0.0, 1.0, "lever arm of rolling resistance over the diameter [-]"),
        option_int("spheres", "N", &spheres, 100, 100000, "spheres poured"),
        option_positive("diameter-mm", "MM", &diameter_mm, 1000.0, "diameter of the spheres [mm]"),
        option_int("heaps", "N", &repeats, 1, HEAPS_MAX, "heaps of each friction; --quick: 1"),
        option_string("stl", "FILE", &stl,
                      "a funnel of your own: mouth up, outlet down, the axis in the middle of its box"),
        option_flag("movie", &film, "angle_of_repose.mp4 of the last heap, by ffmpeg"),
        option_size("size", view.size, "of the picture and the movie [pixels]"),
        option_positive("stl-scale", "M", &scale, 1e6, "length of the file's unit [m]"),
        option_double("outlet", "X", &outlet, 2.0, 1000.0,
                      "height of the outlet over the plate, in diameters; it rises where the heap grows to it [-]"),
    };
    program self =
        program_start("angle_of_repose", "Pours spheres through a funnel onto a plate, and measures the heap's slope.",
                      options, (int)(sizeof options / sizeof *options), argc, argv);
    const double d = 1e-3 * diameter_mm, row[CASES] = {0.05, 0.1, 0.2, 0.4, 0.8}, extremes[2] = {0.1, 0.8};
    const double funnel_points[3][2] = {{2.8 * d, 0.0}, {2.8 * d, 2.0 * d}, {9.0 * d, 10.0 * d}};
    const int n = is_given(&self, "friction") ? 1 : (self.quick ? 2 : CASES);
    char path[1000], message[300] = "", allowed[400];
    dem_mesh funnel, made;
    dem_stl_report found;
    size_t size;
    if (self.quick && !is_given(&self, "spheres")) spheres = 500; /* fewer make no heap */
    if (self.quick && !is_given(&self, "heaps")) repeats = 1;
    if (!stl) {
        made = lathe(funnel_points, 3);
        const int failed = write_stl(self.out, "funnel.stl", &made);
        free(made.vertex), free(made.triangle);
        if (failed) return common_exit_status();
        stl = riddle_io_path(path, sizeof path, self.out, "funnel.stl");
    }
    char *bytes = input_read(stl, &size, message, sizeof message);
    if (!bytes) {
        snprintf(allowed, sizeof allowed, "an STL file that can be read (%s)", message);
        program_refuse(&self, "stl", stl, allowed);
    }
    const dem_status status = dem_read_stl(bytes, size, scale, 1e-4 * d, NULL, &funnel, &found);
    free(bytes);
    if (status != DEM_OK)
        program_refuse(&self, "stl", stl,
                       status == DEM_BAD_DATA ? "an STL file with triangles" : dem_status_text(status));
    dem_vec low, high;
    corners_of(&funnel, &low, &high);
    const double narrow = fmin(high.x - low.x, high.y - low.y) / d, tall = (high.z - low.z) / d;
    if (!(narrow >= 5.0 && narrow <= 1000.0 && tall <= 1000.0)) {
        snprintf(allowed, sizeof allowed,
                 "5 to 1000 sphere diameters wide, no more high; with --stl-scale %.3g it is %.3g wide and %.3g high",
                 scale, narrow, tall);
        program_refuse(&self, "stl", stl, allowed);
    }
    common_print("%s: %ld triangles, %ld open edges, %ld degenerate, %ld duplicate, %ld wrong normals, %ld not finite, "
                 "%ld missing, "
                 "%ld beyond the count, %ld bytes not read\n",
                 stl, (long)funnel.triangles, (long)found.open_edges, (long)found.degenerate, (long)found.duplicate,
                 (long)found.wrong_normals, (long)found.not_finite, (long)found.missing, (long)found.unannounced,
                 (long)found.surplus);

    heap *heaps = calloc((size_t)(n * repeats), sizeof *heaps);
    progress bar;
    if (!heaps) return common_fail("out of memory"), 1;
    progress_begin(&bar, "pouring", n * repeats);
    for (int k = 0; k < n * repeats; k++) {
        heap *h = &heaps[k];
        const int which = k / repeats;
        h->diameter = d, h->friction = n == 1 ? one_friction : (n == CASES ? row[which] : extremes[which]),
        h->rolling = rolling;
        h->spheres = spheres, h->seed = program_seed_of(self.seed, (uint64_t)(k % repeats)), h->funnel = &funnel,
        h->bar = &bar, h->outlet = outlet * d;
        h->folder = k == (n - 1) * repeats ? self.out : NULL, h->film = film; /* the first heap of the last friction */
    }
    jobs_run(n * repeats, self.threads, pour_one, heaps);
    progress_end(&bar);
    for (int k = 0; k < n * repeats; k++) {
        if (heaps[k].status != DEM_OK)
            common_fail("friction %g: %s", heaps[k].friction, dem_status_text(heaps[k].status));
    }
    riddle_io_array none = riddle_io_vector("position", funnel.vertex);
    int *ends = malloc((size_t)funnel.triangles * sizeof *ends);
    for (int k = 0; ends && k < funnel.triangles; k++) ends[k] = 3 * k + 3;
    if (ends)
        riddle_io_polygons(self.out, "funnel.vtp", (int)funnel.vertices, none, (int)funnel.triangles, ends,
                           funnel.triangle, NULL, 0);
    free(ends);
    dem_free_mesh(&funnel);
    if (!common_interrupted() && common_exit_status() == 0) report(&self, heaps, n, repeats, &found);
    free(heaps);
    return common_exit_status();
}
