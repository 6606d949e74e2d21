/* What a shape tells about its contacts: among how many corners a face shares the spring of a pair, and how fast
   contacts are. Reads and writes a shape. Promises: the rate is at most 5 % above the highest one of a single face or
   corner. */
#pragma once
#include "../base/polyhedron.h"
#include "../base/vectors.h"

/* A contact's stiffness over k/m, for motion along its normal and for rotations about the three axes. */
typedef struct dem__modes {
    double of[4][4];
} dem__modes;

/* Adds the spring of a point with part w. u: how fast the point moves along the normal by each motion. */
static inline void dem__add_spring(dem__modes *m, double w, const double *u) {
    for (int k = 0; k < 16; k++) m->of[k / 4][k % 4] += w * u[k / 4] * u[k % 4];
}

/* Returns the largest eigenvalue, or at most 5 % more: the 32nd root of the trace of the 32nd power. */
static inline double dem__highest_rate(const dem__modes *modes) {
    dem__modes m = *modes, square;
    double scale = 0.0, trace = 0.0;
    for (int a = 0; a < 4; a++) scale += m.of[a][a];
    for (int k = 0; k < 16; k++) m.of[k / 4][k % 4] /= scale;
    for (int pass = 0; pass < 5; pass++) {
        memset(&square, 0, sizeof square);
        for (int k = 0; k < 64; k++) square.of[k / 16][k % 4] += m.of[k / 16][k / 4 % 4] * m.of[k / 4 % 4][k % 4];
        m = square;
    }
    for (int a = 0; a < 4; a++) trace += m.of[a][a];
    for (int pass = 0; pass < 5; pass++) trace = sqrt(trace);
    return scale * trace;
}

/* Returns the rate of a single corner, in the direction in which it is highest: along each direction the corner moves
   with the body, and by rotations about the axes. */
static inline double dem__rate_of_corner(const dem_convex *s, dem_vec r) {
    dem__modes m;
    memset(&m, 0, sizeof m);
    for (int a = 0; a < 3; a++) {
        dem_vec axis = dem_vec3(0.0, 0.0, 0.0);
        double own[4] = {0.0, 0.0, 0.0, 0.0};
        *dem_axis_of(&axis, a) = own[a] = 1.0;
        const dem_vec turned = dem__scale(sqrt(s->volume / s->moment[a]), dem__cross(axis, r));
        const double u[4] = {turned.x, turned.y, turned.z, 0.0};
        dem__add_spring(&m, 1.0, own), dem__add_spring(&m, 1.0, u);
    }
    return dem__highest_rate(&m) / (double)s->springs;
}

/* Returns the rate of a face. */
static inline double dem__rate_of_face(const dem_convex *s, int f) {
    const dem_vec n = dem__point(s->plane[f]);
    dem__modes m;
    memset(&m, 0, sizeof m);
    for (int k = s->face_start[f]; k < s->face_start[f + 1]; k++) {
        const dem_vec arm = dem__cross(dem__point(s->corner[s->face_corner[k]]), n);
        double u[4] = {1.0, 0.0, 0.0, 0.0};
        for (int a = 0; a < 3; a++) u[1 + a] = dem_axis(arm, a) * sqrt(s->volume / s->moment[a]);
        dem__add_spring(&m, 1.0 / (double)s->springs, u);
    }
    return dem__highest_rate(&m);
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
