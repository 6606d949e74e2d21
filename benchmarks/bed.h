/* bed.h: the beds that the benchmarks run: 2 000, 20 000, 100 000 or 1 million spheres of 5 mm, 22 diameters deep,
   periodic in x and y, on a floor at z = 0, from a settled start without tangential history (tests/reference/beds;
   side 0.045 or 0.14 m; more are the 20 000 several times along x). k_n 1e5 N/m, k_t 2/7 k_n, e = 0.78,
   friction 0.2, 4e-6 s: 22.7 steps a contact. */
#ifndef RIDDLE_BED_H
#define RIDDLE_BED_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "dem.h"
#include "measure.h"

static const double bed_diameter = 0.005, bed_density = 2534.0, bed_stiffness = 1e5, bed_dt = 4e-6,
                    bed_amplitude = 1e-3, bed_frequency = 50.6;
/* gamma/m_eff [1/s]: e = 0.78 for pairs and for the floor */
static const double bed_pair_damping = 5475.7, bed_floor_damping = 3871.9;
#define BED_FILES "a folder with settled_2000.csv, settled_20000.csv and lammps.csv"

typedef struct bed {
    int n;
    double length_x, length_y;                        /* periodic box [m] */
    double *centres, *diameters, *velocities, *spins; /* [n][3] [m], [n] [m], [n][3] [m/s], [n][3] [rad/s] */
} bed;

static inline void bed_free(bed *b) {
    free(b->centres);
    free(b->diameters);
    free(b->velocities);
    free(b->spins);
    memset(b, 0, sizeof *b);
}

/* The start of `spheres` spheres from a folder. Free with bed_free. 0; or -1 with one line in message and
   nothing to free. */
static inline int bed_read(bed *b, const char *folder, int spheres, char *message, int message_size) {
    char path[1000];
    const int copies = spheres > 20000 ? spheres / 20000 : 1;
    const char *const names[9] = {"x", "y", "z", "vx", "vy", "vz", "omega_x", "omega_y", "omega_z"};
    csv_data data;
    int column[9];
    memset(b, 0, sizeof *b);
    riddle_io_path(path, sizeof path, folder, spheres == 2000 ? "settled_2000.csv" : "settled_20000.csv");
    if (csv_read(path, &data, message, message_size) != 0) return -1;
    for (int k = 0; k < 9; k++) {
        column[k] = csv_column(&data, names[k]);
        if (column[k] < 0) {
            csv_free(&data);
            snprintf(message, (size_t)message_size, "%s: no column %s", path, names[k]);
            return -1;
        }
    }
    b->n = copies * data.rows;
    b->length_y = spheres == 2000 ? 0.045 : 0.14;
    b->length_x = copies * b->length_y;
    const size_t vectors = 3 * (size_t)b->n * sizeof(double);
    b->centres = malloc(vectors);
    b->velocities = malloc(vectors);
    b->spins = malloc(vectors);
    b->diameters = malloc(vectors);
    const int got = b->centres && b->velocities && b->spins && b->diameters;
    for (int i = 0; got && i < b->n; i++) {
        const double *row = data.values + (ptrdiff_t)(i % data.rows) * data.columns;
        for (int k = 0; k < 3; k++) {
            b->centres[3 * i + k] = row[column[k]];
            b->velocities[3 * i + k] = row[column[3 + k]];
            b->spins[3 * i + k] = row[column[6 + k]];
        }
        b->centres[3 * i] += i / data.rows * b->length_y;
        b->diameters[i] = bed_diameter;
    }
    csv_free(&data);
    if (got) return 0;
    bed_free(b);
    snprintf(message, (size_t)message_size, "out of memory");
    return -1;
}

/* The definition of the beds: material 0 the spheres', 1 the floor's. */
static inline dem_def bed_def(const bed *b, double friction, dem_restitution mode) {
    dem_def def = dem_default_def();
    const int glass = dem_add_material(&def, bed_density, 5e10, 0.2),
              ground = dem_add_material(&def, bed_density, 5e10, 0.2);
    const double mass = RIDDLE_PI / 6.0 * bed_diameter * bed_diameter * bed_diameter * bed_density;
    for (int k = 0; k < 2; k++) {
        dem_pair_def *pair = dem_pair(&def, glass, k ? ground : glass);
        const double reduced = k ? mass : 0.5 * mass, gamma = reduced * (k ? bed_floor_damping : bed_pair_damping);
        pair->stiffness = bed_stiffness;
        pair->mode = mode;
        pair->restitution = dem_restitution_of(gamma / (2.0 * sqrt(bed_stiffness * reduced)), mode);
        pair->friction = friction;
    }
    def.dt = bed_dt;
    def.periodic[0] = def.periodic[1] = 1;
    def.high = dem_vec3(b->length_x, b->length_y, 1.0);
    return def;
}

/* The bed on its floor (wall 0), at A (1 - cos 2 pi f t) or at rest. */
static inline dem_status bed_world(dem_world *world, const bed *b, const dem_def *def, int vibrated) {
    const char *field;
    dem_status status = dem_init(world, def, &field);
    if (status != DEM_OK) return status;
    const int floor_wall = dem_add_plane(world, 1, dem_vec3(0.0, 0.0, 0.0), dem_vec3(0.0, 0.0, 1.0));
    if (floor_wall < 0) return (dem_status)-floor_wall;
    if (vibrated)
        status = dem_vibrate(world, floor_wall, dem_vec3(0.0, 0.0, bed_amplitude), dem_vec3(0.0, 0.0, -0.5 * RIDDLE_PI),
                             bed_frequency);
    if (status == DEM_OK) status = dem_add_spheres(world, b->n, b->centres, b->diameters, 0, 0);
    for (int i = 0; i < b->n && status == DEM_OK; i++) {
        const double *v = b->velocities + 3 * i, *w = b->spins + 3 * i;
        status = dem_set_motion(world, i, dem_vec3(v[0], v[1], v[2]), dem_vec3(w[0], w[1], w[2]));
    }
    return status;
}

/* What a bed of another code must share after the same steps: mean height [m] and kinetic energy of the centres [J]. */
static inline void bed_measure(const dem_world *world, double *height, double *energy) {
    *height = *energy = 0.0;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        const dem_vec v = dem_velocity(world, i);
        *height += dem_position(world, i).z / (double)world->count;
        *energy += 0.5 * dem_mass(world, i) * (v.x * v.x + v.y * v.y + v.z * v.z);
    }
}

#endif
