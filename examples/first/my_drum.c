/* my_drum.c - a drum with four lifters, half full of spheres of 3 and 6 mm; two turns.

   cc -O3 -I. examples/first/my_drum.c -lm -o my_drum && ./my_drum     (beside dem.h; writes out/my_drum/)

   For your own case change the numbers below, the materials, the lifters (dem_add_mesh takes any triangles,
   dem_read_stl reads them), and the feed. */
#include "dem_io.h"

static const double radius = 0.05, width = 0.024, speed = 4.0, turns = 2.0; /* [m], [m], [rad/s], [-] */
static const double lifter[] = {0.012, 0.004};                              /* height, thickness [m] */
/* [m], the large ones find room first; [kg], half of it each */
static const double diameter[] = {6e-3, 3e-3}, mass = 0.05;
static const char *const names[] = {"6 mm", "3 mm"};
enum { FRAMES = 60, FEATURES = DEM_LINEAR | DEM_FRICTION };

int main(void) {
    dem_def def = dem_default_def();
    /* [kg/m3], [Pa], [-] */
    int glass = dem_add_material(&def, 2500.0, 5e9, 0.2), steel = dem_add_material(&def, 7850.0, 2e11, 0.3);
    for (int k = glass; k <= steel; k++) {
        dem_pair_def *pair = dem_pair(&def, glass, k);
        pair->stiffness = 300.0, pair->restitution = 0.6, pair->friction = 0.5; /* [N/m], [-], [-] */
    }
    dem_world world;
    dem_status status = dem_init(&world, &def, NULL);
    dem_add_cylinder(&world, steel, dem_vec3(0, 0, 0), dem_vec3(0, 1, 0), radius, 1);
    dem_add_plane(&world, steel, dem_vec3(0, -0.5 * width, 0), dem_vec3(0, 1, 0));
    dem_add_plane(&world, steel, dem_vec3(0, 0.5 * width, 0), dem_vec3(0, -1, 0));
    for (int k = 0; k < 4; k++) { /* at the right, the left, above and below */
        double in = radius - lifter[0], half = 0.5 * lifter[1], low = k % 2 ? -radius : in, high = k % 2 ? -in : radius;
        dem_vec a = k < 2 ? dem_vec3(low, -0.5 * width, -half) : dem_vec3(-half, -0.5 * width, low);
        dem_vec b = k < 2 ? dem_vec3(high, 0.5 * width, half) : dem_vec3(half, 0.5 * width, high);
        dem_add_box(&world, steel, a, b);
    }
    for (int k = 0; k < world.walls; k++) dem_rotate(&world, k, dem_vec3(0, 0, 0), dem_vec3(0, 1, 0), speed);
    for (int k = 0; k < 2; k++) {
        double side = 0.7 * (radius - lifter[0]);
        dem_feed feed = dem_default_feed();
        feed.sizes = dem_one_size(diameter[k]), feed.material = glass, feed.group = k, feed.random = (uint64_t)k,
        feed.tries = 2000;
        feed.region = dem_box_region(dem_vec3(-side, -0.5 * width, -side), dem_vec3(side, 0.5 * width, side));
        if (status == DEM_OK) status = dem_fill_mass(&world, &feed, 0.5 * mass);
        printf("%.0f spheres of %s\n", (double)feed.placed, names[k]);
    }
    if (status == DEM_OK) status = dem_set_time_step(&world, dem_advise(&world, FEATURES, 1.0).advised);

    dem_io_series series = dem_io_open("out/my_drum", "drum");
    riddle_io_status written = RIDDLE_IO_OK;
    double time[FRAMES], unlike[FRAMES];
    for (int f = 0; f < FRAMES && status == DEM_OK && written == RIDDLE_IO_OK; f++) {
        status = dem_run(&world, turns * 2.0 * RIDDLE_PI / speed / FRAMES, FEATURES);
        written = dem_io_add(&series, &world);
        time[f] = world.time, unlike[f] = dem_unlike_contacts(&world, 0);
    }
    dem_io_close(&series);
    riddle_plot *picture = riddle_plot_new("My drum", 1, 2);
    riddle_plot_panel(picture, 0, 0, NULL, NULL);
    dem_io_section(&world, picture, dem_vec3(0, 0, 0), dem_vec3(0, -1, 0), dem_vec3(1, 0, 0), names, 2);
    riddle_plot_panel(picture, 0, 1, "time [s]", "unlike contacts, 1: mixed [-]");
    riddle_plot_line(picture, NULL, time, unlike, status == DEM_OK && written == RIDDLE_IO_OK ? FRAMES : 0);
    if (riddle_plot_write(picture, "out/my_drum", "my_drum.svg") != RIDDLE_IO_OK) written = RIDDLE_IO_NOT_WRITTEN;
    printf("%s after %.2f s\n", written ? riddle_io_status_text(written) : dem_status_text(status), world.time);
    dem_free(&world);
    return status != DEM_OK || written != RIDDLE_IO_OK;
}
