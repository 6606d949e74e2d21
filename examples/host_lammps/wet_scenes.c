/* The scenes of host_lammps in dem.h alone: a wet bed of spheres on a vibrating floor and wet spheres in a rotating
   drum. Writes the start as a LAMMPS data file and the course as a CSV with the columns of measure.lammps, so that both
   codes can be compared.

   To change for your own case: bed_scene and drum_scene below, and the same numbers in bed.lammps and drum.lammps. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "dem_wet.h"

static const double water_density = 1000.0, sphere_density = 2534.0;

typedef struct start {
    int n;
    double *centre, *velocity, *diameter; /* [n][3] [m], [n][3] [m/s], [n] [m] */
    double low[3], high[3];               /* of LAMMPS's box [m] */
} start;

static int start_allocate(start *s, int n) {
    s->n = n;
    s->centre = malloc((size_t)n * 7 * sizeof(double));
    if (!s->centre) return common_fail("out of memory");
    s->velocity = s->centre + 3 * (size_t)n;
    s->diameter = s->velocity + 3 * (size_t)n;
    return 0;
}

/* The same scene with other seeds: velocities of up to 1 mm/s that differ. */
static void start_shake(start *s, uint64_t seed) {
    uint64_t state = seed * 0x9e3779b97f4a7c15u + 1u;
    for (int k = 0; k < 3 * s->n; k++) s->velocity[k] = 1e-3 * (2.0 * random_plain(&state) - 1.0);
}

static int write_data(const start *s, const char *path) {
    riddle_io_file *f = riddle_io_open(NULL, path);
    if (!f) return -1;
    riddle_io_print(f, "start of a wet scene, by wet_scenes\n\n%d atoms\n1 atom types\n\n", s->n);
    for (int a = 0; a < 3; a++)
        riddle_io_print(f, "%.17g %.17g %clo %chi\n", s->low[a], s->high[a], "xyz"[a], "xyz"[a]);
    riddle_io_print(f, "\nAtoms # sphere\n\n");
    for (int i = 0; i < s->n; i++)
        riddle_io_print(f, "%d 1 %.17g %.17g %.17g %.17g %.17g\n", i + 1, s->diameter[i], sphere_density,
                        s->centre[3 * i], s->centre[3 * i + 1], s->centre[3 * i + 2]);
    riddle_io_print(f, "\nVelocities\n\n");
    for (int i = 0; i < s->n; i++)
        riddle_io_print(f, "%d %.17g %.17g %.17g 0 0 0\n", i + 1, s->velocity[3 * i], s->velocity[3 * i + 1],
                        s->velocity[3 * i + 2]);
    return riddle_io_close(f);
}

/* ---- scenes ---- */

static dem_def definition(double stiffness, double friction, double wall_friction, double dt) {
    dem_def def = dem_default_def();
    const int glass = dem_add_material(&def, sphere_density, 5e10, 0.2),
              wall = dem_add_material(&def, sphere_density, 5e10, 0.2);
    for (int k = 0; k < 2; k++) {
        dem_pair_def *pair = dem_pair(&def, glass, k ? wall : glass);
        pair->stiffness = stiffness;
        pair->restitution = 0.78;
        pair->friction = k ? wall_friction : friction;
    }
    def.dt = dt;
    return def;
}

/* The bed of benchmarks/README.md with 2 000 spheres. */
static int bed_scene(start *s, dem_world *world, const char *folder, double amplitude) {
    static const char *const names[3] = {"x", "y", "z"};
    char path[1000], message[1200];
    csv_data data;
    riddle_io_path(path, sizeof path, folder, "settled_2000.csv");
    if (csv_read(path, &data, message, sizeof message) != 0) return common_fail("%s", message);
    if (start_allocate(s, data.rows) != 0) return -1;
    for (int i = 0; i < s->n; i++) {
        s->diameter[i] = 0.005;
        for (int a = 0; a < 3; a++) s->centre[3 * i + a] = csv_value(&data, i, names[a]);
    }
    csv_free(&data);
    dem_def def = definition(1e5, 0.2, 0.2, 4e-6);
    def.periodic[0] = def.periodic[1] = 1;
    def.high = dem_vec3(0.045, 0.045, 1.0);
    for (int a = 0; a < 3; a++) s->low[a] = a == 2 ? -0.01 : 0.0, s->high[a] = a == 2 ? 0.5 : 0.045;
    if (dem_init(world, &def, NULL) != DEM_OK) return common_fail("the bed cannot be made");
    const int floor_wall = dem_add_plane(world, 1, dem_vec3(0.0, 0.0, 0.0), dem_vec3(0.0, 0.0, 1.0));
    return dem_vibrate(world, floor_wall, dem_vec3(0.0, 0.0, amplitude), dem_vec3(0.0, 0.0, -0.5 * RIDDLE_PI), 50.6) ==
                   DEM_OK
               ? 0
               : -1;
}

/* A drum of 60 mm, 20 mm long, periodic along its axis z, 60 turns a minute, a third full of spheres of 2.5 mm. */
static int drum_scene(start *s, dem_world *world, uint64_t seed) {
    enum { SPHERES = 1200 };
    dem_def def = definition(1e4, 0.3, 0.5, 5e-6);
    def.gravity = dem_vec3(0.0, -9.81, 0.0);
    def.periodic[2] = 1;
    def.low = dem_vec3(-0.1, -0.1, 0.0);
    def.high = dem_vec3(0.1, 0.1, 0.02);
    for (int a = 0; a < 3; a++) s->low[a] = a == 2 ? 0.0 : -0.031, s->high[a] = a == 2 ? 0.02 : 0.031;
    if (start_allocate(s, SPHERES) != 0 || dem_init(world, &def, NULL) != DEM_OK)
        return common_fail("the drum cannot be made");
    const int drum = dem_add_cylinder(world, 1, dem_vec3(0.0, 0.0, 0.0), dem_vec3(0.0, 0.0, 1.0), 0.03, 1);
    dem_feed feed = dem_default_feed();
    feed.region = dem_cylinder_region(dem_vec3(0.0, 0.0, 0.0), dem_vec3(0.0, 0.0, 1.0), 0.02, 0.0285);
    feed.sizes = dem_one_size(0.0025);
    feed.random = seed;
    if (dem_fill(world, &feed, SPHERES) != DEM_OK || world->count != SPHERES)
        return common_fail("the drum cannot be filled");
    for (int i = 0; i < SPHERES; i++) {
        const dem_vec x = dem_position(world, i);
        s->centre[3 * i] = x.x, s->centre[3 * i + 1] = x.y, s->centre[3 * i + 2] = x.z;
        s->diameter[i] = 0.0025;
    }
    return dem_rotate(world, drum, dem_vec3(0.0, 0.0, 0.0), dem_vec3(0.0, 0.0, 1.0), 2.0 * RIDDLE_PI) == DEM_OK ? 0
                                                                                                                : -1;
}

/* Wets the spheres of a world whose wall 0 is its only one. Walls stay dry: at rupture a sphere takes back
   what it gave. */
static int wet(wet_scene *wet, dem_world *world, const start *s, const int *group, double moisture) {
    dem_screen screen = dem_default_screen();
    const double classes[WET_CLASSES] = {s->diameter[0], s->diameter[0], s->diameter[0]};
    double mass = 0.0;
    screen.centre = dem_vec3(0.0, 0.0, -50.0);
    for (int i = 0; i < s->n; i++)
        mass += RIDDLE_PI / 6.0 * sphere_density * s->diameter[i] * s->diameter[i] * s->diameter[i];
    const int deck = dem_add_screen(world, 1, &screen); /* the books of dem_wet.h want one; it is out of the way */
    if (deck < 0 || dem_enable_wall(world, deck, 0) != DEM_OK) return -1;
    if (wet_init(wet, s->n, group, s->diameter, classes, moisture * 1000.0 / water_density, mass, deck, world, false,
                 WET_STEEL) != BRIDGE_OK)
        return -1;
    world->user = wet;
    for (int a = 0; a < WET_CLASSES; a++) {
        for (int wall = WET_DECK; wall < WET_PARTNERS; wall++) {
            bridge_pair_def def = wet->kind[a][wall].def;
            def.split = BRIDGE_SPLIT_RETURN;
            if (bridge_pair_prepare(&wet->kind[a][wall], &def) != BRIDGE_OK) return -1;
        }
    }
    return 0;
}

static void measure(riddle_io_file *file, const wet_scene *wet, const dem_world *world, int up) {
    double height = 0.0, energy = 0.0;
    int bridges;
    const double liquid = wet_total(wet, world, &bridges);
    for (ptrdiff_t i = 0; i < world->count; i++) {
        const dem_vec v = dem_velocity(world, i), x = dem_position(world, i);
        height += (up == 2 ? x.z : x.y) / (double)world->count;
        energy += 0.5 * dem_mass(world, i) * (v.x * v.x + v.y * v.y + v.z * v.z);
    }
    csv_line(file, "%.9g,%d,%.17g,%.17g,%.17g", world->time, bridges, liquid, height, energy);
}

int main(int argc, char **argv) {
    int scene = 0;
    bool dry = false;
    double duration = 0.1, every = 1e-3, moisture = 0.01, amplitude = 1e-3;
    char place[600];
    const char *folder = output_find(place, sizeof place, "tests/reference/beds"), *data = NULL;
    option options[] = {
        option_choice("scene", &scene, "bed|drum", "which scene"),
        option_positive("time", "S", &duration, 1e3, "simulated time [s]"),
        option_positive("every", "S", &every, 1e3, "between two lines of the course [s]"),
        option_double("moisture", "SHARE", &moisture, 1e-4, 0.05, "mass of water over mass of spheres [-]"),
        option_double("amplitude", "M", &amplitude, 0.0, 0.01, "of the floor of the bed [m]"),
        option_flag("dry", &dry, "without liquid: what the wet run is compared with"),
        option_string("beds", "DIR", &folder, "folder of the bed's start"),
        option_string("data", "FILE", &data, "write the start as a LAMMPS data file and run nothing"),
    };
    program self =
        program_start("wet_scenes", "The scenes of host_lammps in dem.h: a wet vibrated bed, a wet rotating drum.",
                      options, sizeof options / sizeof *options, argc, argv);
    if (self.quick && !is_given(&self, "time")) duration = 0.01;
    start s = {0};
    dem_world world;
    wet_scene books;
    memset(&world, 0, sizeof world);
    memset(&books, 0, sizeof books);
    int failed = scene ? drum_scene(&s, &world, self.seed) : bed_scene(&s, &world, folder, amplitude);
    if (!failed) start_shake(&s, self.seed);
    if (!failed && data) failed = write_data(&s, data);
    if (!failed && !data) {
        int *group = calloc((size_t)s.n, sizeof *group);
        dem_status status = group ? DEM_OK : DEM_OUT_OF_MEMORY;
        if (status == DEM_OK && !scene) status = dem_add_spheres(&world, s.n, s.centre, s.diameter, 0, 0);
        for (int i = 0; i < s.n && status == DEM_OK; i++)
            status =
                dem_set_motion(&world, i, dem_vec3(s.velocity[3 * i], s.velocity[3 * i + 1], s.velocity[3 * i + 2]),
                               dem_vec3(0.0, 0.0, 0.0));
        if (status == DEM_OK && !dry && wet(&books, &world, &s, group, moisture) != 0) status = DEM_BAD_ARGUMENT;
        riddle_io_file *file = csv_open(self.out, "course.csv", "time_s,bridges,liquid_m3,height_m,kinetic_energy_J");
        double cpu = 0.0;
        progress bar;
        progress_begin(&bar, scene ? "drum" : "bed", duration);
        while (status == DEM_OK && world.time < duration - 0.5 * world.def.dt && !common_interrupted()) {
            const double begun = machine_processor_seconds();
            status = dry ? dem_run(&world, every, DEM_LINEAR | DEM_FRICTION) : wet_run(&world, every, 0);
            cpu += machine_processor_seconds() - begun;
            if (!dry) measure(file, &books, &world, scene ? 1 : 2);
            progress_update(&bar, world.time);
        }
        progress_end(&bar);
        riddle_io_close(file);
        if (status != DEM_OK) common_fail("%s", dem_status_text(status));
        printf("%s: %d spheres, %.4g s, %.3g s of processor time, %.3g particle-steps/s\n", scene ? "drum" : "bed", s.n,
               world.time, cpu, s.n * world.time / world.def.dt / (cpu > 0.0 ? cpu : 1.0));
        free(group);
    }
    dem_free(&world);
    wet_free(&books);
    free(s.centre);
    return common_exit_status();
}
