/* What a shape tells about its contacts: among how many corners a face shares the spring of a pair, and how fast
   contacts are. Reads and writes a shape. Promises: the rate is at most 5 % above the highest one of a single face or
   corner. */
#pragma once
#include "../base/modes.h"
#include "../base/polyhedron.h"

/* Sets the mass over the principal moments [1/m2]. */
static inline void dem__agility_of(const dem_convex *s, double *agility) {
    for (int a = 0; a < 3; a++) agility[a] = s->volume / s->moment[a];
}

/* Returns the rate of a single corner, in the direction in which it is highest: along each direction the corner moves
   with the body, and by rotations about the axes. */
static inline double dem__rate_of_corner(const dem_convex *s, dem_vec r) {
    double agility[3];
    dem__modes m;
    memset(&m, 0, sizeof m);
    dem__agility_of(s, agility);
    for (int a = 0; a < 3; a++) {
        dem_vec axis = dem_vec3(0.0, 0.0, 0.0);
        double own[4] = {0.0, 0.0, 0.0, 0.0};
        *dem_axis_of(&axis, a) = own[a] = 1.0;
        const dem_vec turned = dem__scale(sqrt(agility[a]), dem__cross(axis, r));
        const double u[4] = {turned.x, turned.y, turned.z, 0.0};
        dem__add_spring(&m, 1.0, own), dem__add_spring(&m, 1.0, u);
    }
    return dem__highest_rate(&m, 5) / (double)s->springs;
}

/* Returns the rate of a face. */
static inline double dem__rate_of_face(const dem_convex *s, int f) {
    const dem_vec n = dem__point(s->plane[f]);
    double agility[3];
    dem__modes m;
    memset(&m, 0, sizeof m);
    dem__agility_of(s, agility);
    for (int k = s->face_start[f]; k < s->face_start[f + 1]; k++)
        dem__add_spring_at(&m, 1.0 / (double)s->springs, dem__point(s->corner[s->face_corner[k]]), n, agility);
    return dem__highest_rate(&m, 5);
}

/* Sets how many corners share a spring, and the rate. */
static inline void dem__find_springs(dem_convex *s) {
    s->springs = 1, s->rate = 1.0;
    for (int f = 0; f < s->faces; f++) {
        const int corners = s->face_start[f + 1] - s->face_start[f];
        s->springs = corners > s->springs ? corners : s->springs;
    }
    for (int f = 0; f < s->faces; f++) {
        const double rate = dem__rate_of_face(s, f);
        s->rate = rate > s->rate ? rate : s->rate;
    }
    for (int k = 0; k < s->corners; k++) {
        const double rate = dem__rate_of_corner(s, dem__point(s->corner[k]));
        s->rate = rate > s->rate ? rate : s->rate;
    }
}
