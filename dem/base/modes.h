/* How fast a body answers to its contacts: the highest rate of all springs that act on it at once. */
#pragma once
#include "vectors.h"

/* The stiffness of contacts over k/m, for motion along their normal and for rotations about the three axes. */
typedef struct dem__modes {
    double of[4][4];
} dem__modes;

/* Adds the spring of a point with part w. u: how fast the point moves along the normal by each motion. */
static inline void dem__add_spring(dem__modes *m, double w, const double *u) {
    for (int k = 0; k < 16; k++) m->of[k / 4][k % 4] += w * u[k / 4] * u[k % 4];
}

/* Adds the spring of a point at r from the centre of mass. agility: mass over the principal moments [1/m2]. */
static inline void dem__add_spring_at(dem__modes *m, double w, dem_vec r, dem_vec normal, const double *agility) {
    const dem_vec arm = dem__cross(r, normal);
    double u[4] = {1.0, 0.0, 0.0, 0.0};
    for (int a = 0; a < 3; a++) u[1 + a] = dem_axis(arm, a) * sqrt(agility[a]);
    dem__add_spring(m, w, u);
}

/* Returns the largest eigenvalue, or more, at most 20 % after 3 passes and 5 % after 5. Each squares the matrix: it is
   the 8th root of the trace of the 8th power, or the 32nd of the 32nd. */
static inline double dem__highest_rate(const dem__modes *modes, int passes) {
    dem__modes m = *modes, square;
    double scale = 0.0, trace = 0.0;
    for (int a = 0; a < 4; a++) scale += m.of[a][a];
    for (int k = 0; k < 16; k++) m.of[k / 4][k % 4] /= scale;
    for (int pass = 0; pass < passes; pass++) {
        memset(&square, 0, sizeof square);
        for (int k = 0; k < 64; k++) square.of[k / 16][k % 4] += m.of[k / 16][k / 4 % 4] * m.of[k / 4 % 4][k % 4];
        m = square;
    }
    for (int a = 0; a < 4; a++) trace += m.of[a][a];
    for (int pass = 0; pass < passes; pass++) trace = sqrt(trace);
    return scale * trace;
}
