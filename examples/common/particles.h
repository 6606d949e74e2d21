/* particles.h: spheres from a table: CSV with named columns, or .vtp as riddle_io_points() writes it (binary, appended,
   raw).

       particles start;
       if (particles_read("start.csv", &start, message, sizeof message) == 0)
           dem_add_spheres(&world, start.n, start.centre, start.diameter, glass, 0);
       particles_free(&start);

   CSV columns: x, y, z, and diameter or radius; if there are: vx, vy, vz; omega_x, omega_y, omega_z; group or class. A
   unit may follow after an underscore or in brackets (x_mm, "diameter [um]", vx_m_s); without one numbers are SI. .vtp
   arrays: the points [m]; diameter or radius; if there are: velocity; spin; group, class or species;
   units as in CSV. */
#ifndef RIDDLE_PARTICLES_H
#define RIDDLE_PARTICLES_H

#include <stddef.h>

typedef struct particles {
    int n;
    double *centre, *velocity, *spin; /* [n][3] [m], [m/s], [rad/s]; what the table lacks is 0 */
    double *diameter;                 /* [n] [m] > 0 */
    int *group;                       /* [n] */
    void *memory;                     /* everything above points into here */
} particles;

/* 0, or -1 with one line in message; *p is then empty. Free with particles_free. A path that ends in .vtp is
   one, else CSV. */
int particles_read(const char *path, particles *p, char *message, int message_size);
/* From memory. */
int particles_parse(const char *bytes, size_t size, const char *path, particles *p, char *message, int message_size);
void particles_free(particles *p);

#endif
