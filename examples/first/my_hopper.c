/* my_hopper.c - a conical hopper whose gate is drawn aside after half a second: how fast it runs out.

   cc -O3 -I. examples/first/my_hopper.c -lm -o my_hopper && ./my_hopper     (beside dem.h; writes out/my_hopper/)

   For your own case change the numbers below, the materials, the cone (or a mesh: dem_add_mesh), and the feed. */
#include "dem_io.h"

static const double outlet = 0.03, top = 0.1, wall = 0.1, slope = 60.0; /* diameters, height above it [m]; [degrees] */
static const double diameter = 5e-3, mass = 0.15, shut = 0.5, duration = 1.5; /* [m], [kg], [s] */
enum { FRAMES = 75, FEATURES = DEM_LINEAR | DEM_FRICTION };

/* The gate is drawn aside along x within a tenth of a second. */
static void draw_aside(void *user, double time, dem_pose *pose) {
    (void)user;
    double share = (time - shut) / 0.1;
    pose->shift.x = share < 0.0 ? 0.0 : share > 1.0 ? 2.0 * outlet : 2.0 * outlet * share * share * (3.0 - 2.0 * share);
}

int main(void) {
    dem_def def = dem_default_def();
    int glass = dem_add_material(&def, 2500.0, 5e9, 0.2), steel = dem_add_material(&def, 7850.0, 2e11, 0.3); /* SI */
    for (int k = glass; k <= steel; k++) {
        dem_pair_def *pair = dem_pair(&def, glass, k);
        pair->stiffness = 1000.0, pair->restitution = 0.5, pair->friction = 0.4; /* [N/m], [-], [-] */
    }
    dem_world world;
    dem_status status = dem_init(&world, &def, NULL);
    dem_cone cone = dem_default_cone();
    double height = 0.5 * (top - outlet) * tan(slope * RIDDLE_PI / 180.0);
    cone.low_radius = 0.5 * outlet, cone.high_radius = 0.5 * top, cone.high = dem_vec3(0, 0, height);
    dem_add_cone(&world, steel, &cone);
    cone.low = cone.high, cone.low_radius = cone.high_radius, cone.high.z = height + wall; /* a tube */
    dem_add_cone(&world, steel, &cone);
    int gate = dem_add_box(&world, steel, dem_vec3(-0.7 * outlet, -0.7 * outlet, -0.004),
                           dem_vec3(0.7 * outlet, 0.7 * outlet, -0.001));
    dem_prescribe(&world, gate, dem_vec3(0, 0, 0), draw_aside, NULL);
    dem_add_exit(&world, dem_vec3(0, 0, -0.06), dem_vec3(0, 0, 1));

    dem_feed feed = dem_default_feed();
    feed.sizes = dem_uniform_sizes(0.9 * diameter, 1.1 * diameter, 1), feed.material = glass, feed.tries = 500;
    feed.region = dem_cylinder_region(dem_vec3(0, 0, height), dem_vec3(0, 0, 1), wall, 0.5 * top);
    if (status == DEM_OK) status = dem_fill_mass(&world, &feed, mass);
    if (status == DEM_OK) status = dem_set_time_step(&world, dem_advise(&world, FEATURES, 1.0).advised);

    dem_io_series series = dem_io_open("out/my_hopper", "hopper");
    riddle_io_status written = RIDDLE_IO_OK;
    riddle_plot *picture = riddle_plot_new("My hopper", 1, 2);
    riddle_plot_panel(picture, 0, 0, NULL, NULL);
    double time[FRAMES], out[FRAMES];
    for (int f = 0; f < FRAMES && status == DEM_OK && written == RIDDLE_IO_OK; f++) {
        status = dem_run(&world, duration / FRAMES, FEATURES);
        written = dem_io_add(&series, &world);
        if (f == (int)(FRAMES * (shut + 0.3) / duration))
            dem_io_section(&world, picture, dem_vec3(0, 0, 0), dem_vec3(0, -1, 0), dem_vec3(1, 0, 0), NULL, 0);
        time[f] = world.time, out[f] = feed.placed_mass * (double)world.passed_count / (double)feed.placed;
    }
    dem_io_close(&series);
    riddle_plot_panel(picture, 0, 1, "time [s]", "mass that has run out [kg]");
    riddle_plot_line(picture, NULL, time, out, status == DEM_OK && written == RIDDLE_IO_OK ? FRAMES : 0);
    riddle_plot_vertical(picture, "gate opens", shut);
    if (riddle_plot_write(picture, "out/my_hopper", "my_hopper.svg") != RIDDLE_IO_OK) written = RIDDLE_IO_NOT_WRITTEN;
    const char *said = written ? riddle_io_status_text(written) : dem_status_text(status);
    printf("%s: %d of %d spheres ran out in %.2f s\n", said, (int)world.passed_count, (int)feed.placed, world.time);
    dem_free(&world);
    return status != DEM_OK || written != RIDDLE_IO_OK;
}
