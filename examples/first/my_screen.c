/* my_screen.c - glass spheres of 4 and 8 mm on a vibrating screen with apertures of 6 mm: how many small ones are left.

   cc -O3 -I. examples/first/my_screen.c -lm -o my_screen && ./my_screen     (beside dem.h; writes out/my_screen/)

   For your own case change the numbers below, the materials, the deck, and the sizes, mass and box of the feed. */
#include "dem_io.h"

static const double aperture = 6e-3, wire = 1.5e-3, half = 0.0525; /* [m]; half a side of the deck: 7 pitches */
static const double amplitude = 1.5e-3, frequency = 25.0, duration = 3.0, mass = 0.2; /* [m], [Hz], [s], [kg] */
static const double diameter[] = {4e-3, 8e-3};                                        /* [m], half of the mass each */
static const char *const names[] = {"4 mm", "8 mm"};
enum { FRAMES = 60, FEATURES = DEM_LINEAR | DEM_FRICTION };

int main(void) {
    dem_def def = dem_default_def();
    /* [kg/m3], [Pa], [-] */
    int glass = dem_add_material(&def, 2500.0, 5e9, 0.2), steel = dem_add_material(&def, 7850.0, 2e11, 0.3);
    dem_pair(&def, glass, glass)->stiffness = dem_pair(&def, glass, steel)->stiffness = 2000.0; /* [N/m] */
    dem_pair(&def, glass, glass)->restitution = 0.78, dem_pair(&def, glass, steel)->restitution = 0.44;
    dem_world world;
    dem_status status = dem_init(&world, &def, NULL);

    dem_screen screen = dem_default_screen();
    screen.aperture = aperture, screen.wire = wire, screen.circular = 0, screen.half_x = screen.half_y = half;
    dem_add_screen(&world, steel, &screen);
    dem_add_plane(&world, steel, dem_vec3(-half, 0, 0), dem_vec3(1, 0, 0)); /* the frame around it */
    dem_add_plane(&world, steel, dem_vec3(half, 0, 0), dem_vec3(-1, 0, 0));
    dem_add_plane(&world, steel, dem_vec3(0, -half, 0), dem_vec3(0, 1, 0));
    dem_add_plane(&world, steel, dem_vec3(0, half, 0), dem_vec3(0, -1, 0));
    for (int k = 0; k < world.walls; k++)
        dem_vibrate(&world, k, dem_vec3(0, 0, amplitude), dem_vec3(0, 0, 0), frequency);
    dem_add_exit(&world, dem_vec3(0, 0, -0.03), dem_vec3(0, 0, 1));

    double fed[2], time[FRAMES], left[2][FRAMES] = {{0.0}};
    for (int k = 0; k < 2; k++) {
        dem_feed feed = dem_default_feed();
        feed.sizes = dem_one_size(diameter[k]), feed.material = glass, feed.group = k, feed.random = (uint64_t)k;
        feed.region = dem_box_region(dem_vec3(-half, -half, 0.01), dem_vec3(half, half, 0.08));
        if (status == DEM_OK) status = dem_fill_mass(&world, &feed, 0.5 * mass);
        fed[k] = (double)feed.placed;
    }
    if (status == DEM_OK) status = dem_set_time_step(&world, dem_advise(&world, FEATURES, 1.0).advised);

    dem_io_series series = dem_io_open("out/my_screen", "screen");
    riddle_io_status written = RIDDLE_IO_OK;
    riddle_plot *picture = riddle_plot_new("My screen", 1, 2);
    riddle_plot_panel(picture, 0, 0, NULL, NULL);
    for (int f = 0; f < FRAMES && status == DEM_OK && written == RIDDLE_IO_OK; f++) {
        status = dem_run(&world, duration / FRAMES, FEATURES);
        written = dem_io_add(&series, &world);
        if (f == 8) dem_io_section(&world, picture, dem_vec3(0, 0, 0), dem_vec3(0, -1, 0), dem_vec3(1, 0, 0), names, 2);
        time[f] = world.time, left[0][f] = left[1][f] = 1.0;
        for (ptrdiff_t k = 0; k < world.passed_count; k++)
            left[world.passed[k].group][f] -= 1.0 / fed[world.passed[k].group];
    }
    dem_io_close(&series);
    riddle_plot_panel(picture, 0, 1, "time [s]", "fraction retained, by number [-]");
    for (int k = 0; k < 2 && status == DEM_OK && !written; k++)
        riddle_plot_line(picture, names[k], time, left[k], FRAMES);
    if (riddle_plot_write(picture, "out/my_screen", "my_screen.svg") != RIDDLE_IO_OK) written = RIDDLE_IO_NOT_WRITTEN;
    if (status != DEM_OK || written)
        printf("%s after %.2f s\n", written ? riddle_io_status_text(written) : dem_status_text(status), world.time);
    else printf("ok: %.0f and %.0f spheres, of the small ones %.3f are left\n", fed[0], fed[1], left[0][FRAMES - 1]);
    dem_free(&world);
    return status != DEM_OK || written != RIDDLE_IO_OK;
}
