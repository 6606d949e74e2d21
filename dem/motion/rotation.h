/* Quaternions and the free rotation of a rigid body: pure functions. A quaternion turns vectors of the body's frame
   into the lab's; its scalar part comes first. */
#pragma once
#include "../base/vectors.h"
#include "../base/polyhedron.h"

DEM_INLINE dem_quaternion dem__quaternion(double w, dem_vec v) {
    dem_quaternion q;
    q.w = w, q.x = v.x, q.y = v.y, q.z = v.z;
    return q;
}
DEM_INLINE dem_vec dem__vector_part(dem_quaternion q) { return dem_vec3(q.x, q.y, q.z); }
DEM_INLINE dem_quaternion dem__opposite_turn(dem_quaternion q) {
    return dem__quaternion(q.w, dem_vec3(-q.x, -q.y, -q.z));
}

/* Returns the rotation b followed by the rotation a. */
DEM_INLINE dem_quaternion dem__turns(dem_quaternion a, dem_quaternion b) {
    const dem_vec u = dem__vector_part(a), v = dem__vector_part(b);
    return dem__quaternion(a.w * b.w - dem__dot(u, v),
                           dem__add(dem__plus(dem__scale(a.w, v), b.w, u), dem__cross(u, v)));
}

/* Transforms a vector from the body's frame to the lab's. */
DEM_INLINE dem_vec dem__to_lab(dem_quaternion q, dem_vec v) {
    const dem_vec u = dem__vector_part(q), t = dem__scale(2.0, dem__cross(u, v));
    return dem__add(dem__plus(v, q.w, t), dem__cross(u, t));
}
/* Transforms a vector from the lab's frame to the body's. */
DEM_INLINE dem_vec dem__to_body(dem_quaternion q, dem_vec v) { return dem__to_lab(dem__opposite_turn(q), v); }

/* Removes the rounding error of the length by one Newton step for the inverse of the length. */
DEM_INLINE dem_quaternion dem__kept_unit(dem_quaternion q) {
    const double f = 1.5 - 0.5 * (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return dem__quaternion(f * q.w, dem__scale(f, dem__vector_part(q)));
}

/* Scales a quaternion of any length to length 1. Returns 0 if it has no direction. */
static inline int dem__unit_turn(dem_quaternion q, dem_quaternion *unit) {
    const double a = fabs(q.w) > fabs(q.x) ? fabs(q.w) : fabs(q.x), b = fabs(q.y) > fabs(q.z) ? fabs(q.y) : fabs(q.z),
                 most = a > b ? a : b;
    if (!(most > 0.0 && most <= DBL_MAX) || !(fabs(q.w) + fabs(q.x) + fabs(q.y) + fabs(q.z) >= 0.0)) return 0;
    const double w = q.w / most, x = q.x / most, y = q.y / most, z = q.z / most,
                 f = 1.0 / sqrt(w * w + x * x + y * y + z * z);
    *unit = dem__quaternion(f * w, dem_vec3(f * x, f * y, f * z));
    return 1;
}

/* Returns the rotation from the principal axes of a shape, the frame of its corners, to the frame in which it was
   given. It is exactly none if both agree, as for a brick. Computed from the largest of the four components, whose
   square is 1/4 or more. */
static inline dem_quaternion dem__turn_of_shape(const dem_convex *s) {
    const dem_vec a = s->axis[0], b = s->axis[1], c = s->axis[2]; /* columns of its matrix */
    const double four[4] = {1.0 + a.x + b.y + c.z, 1.0 + a.x - b.y - c.z, 1.0 - a.x + b.y - c.z, 1.0 - a.x - b.y + c.z};
    const dem_quaternion none = dem__quaternion(1.0, dem_vec3(0.0, 0.0, 0.0));
    dem_quaternion q = dem__quaternion(four[0], dem_vec3(b.z - c.y, c.x - a.z, a.y - b.x));
    int k = 0;
    for (int n = 1; n < 4; n++) k = four[n] > four[k] ? n : k;
    if (k == 1) q = dem__quaternion(b.z - c.y, dem_vec3(four[1], a.y + b.x, a.z + c.x));
    if (k == 2) q = dem__quaternion(c.x - a.z, dem_vec3(a.y + b.x, four[2], b.z + c.y));
    if (k == 3) q = dem__quaternion(a.y - b.x, dem_vec3(a.z + c.x, b.z + c.y, four[3]));
    return dem__unit_turn(q, &q) ? q : none; /* a forged save may hold anything */
}

/* Directions of a body's own axes in the lab's frame: the matrix of its orientation. Turning several vectors with it
   costs fewer operations than with a quaternion. */
typedef struct dem__axes {
    dem_vec x, y, z;
} dem__axes;
DEM_INLINE dem_vec dem__first_axis(dem_quaternion q) {
    return dem_vec3(1.0 - 2.0 * (q.y * q.y + q.z * q.z), 2.0 * (q.x * q.y + q.w * q.z), 2.0 * (q.x * q.z - q.w * q.y));
}
DEM_INLINE dem_vec dem__second_axis(dem_quaternion q) {
    return dem_vec3(2.0 * (q.x * q.y - q.w * q.z), 1.0 - 2.0 * (q.x * q.x + q.z * q.z), 2.0 * (q.y * q.z + q.w * q.x));
}
DEM_INLINE dem_vec dem__third_axis(dem_quaternion q) {
    return dem_vec3(2.0 * (q.x * q.z + q.w * q.y), 2.0 * (q.y * q.z - q.w * q.x), 1.0 - 2.0 * (q.x * q.x + q.y * q.y));
}
DEM_INLINE dem__axes dem__axes_of(dem_quaternion q) {
    dem__axes a;
    a.x = dem__first_axis(q), a.y = dem__second_axis(q), a.z = dem__third_axis(q);
    return a;
}
DEM_INLINE dem_vec dem__out_of(const dem__axes *a, dem_vec v) {
    return dem__plus(dem__plus(dem__scale(v.x, a->x), v.y, a->y), v.z, a->z);
}

/* Returns the angular momentum of a spin, both in the lab's frame. */
DEM_INLINE dem_vec dem__momentum_of(dem_quaternion q, dem_vec moments, dem_vec spin) {
    const dem__axes a = dem__axes_of(q);
    return dem__out_of(&a, dem_vec3(moments.x * dem__dot(a.x, spin), moments.y * dem__dot(a.y, spin),
                                    moments.z * dem__dot(a.z, spin)));
}
/* Returns the spin that belongs to an angular momentum, both in the lab's frame: that of a sphere of the first moment,
   corrected for the other two moments. */
DEM_INLINE dem_vec dem__spin_of(dem_quaternion q, dem_vec moments, dem_vec momentum) {
    const dem_vec z = dem__third_axis(q);
    const double first = 1.0 / moments.x;
    dem_vec spin = dem__plus(dem__scale(first, momentum), (1.0 / moments.z - first) * dem__dot(z, momentum), z);
    if (moments.x == moments.y) return spin;
    const dem_vec y = dem__second_axis(q);
    return dem__plus(spin, (1.0 / moments.y - first) * dem__dot(y, momentum), y);
}

/* Sets the cosine, and the sine over the angle, of an angle whose square is given [rad2]. Below 0.1 rad the series is
   as accurate, and cheaper. Whole turns are subtracted from a large angle, which is rounded by as much anyway. */
DEM_INLINE void dem__cosine_and_sine(double square, double *c, double *s) {
    if (square < 0.01) {
        *s = 1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0 - square * (1.0 / 5040.0 - square * (1.0 / 362880.0))));
        *c = 1.0 - square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0 - square * (1.0 / 40320.0))));
        return;
    }
    const double angle = sqrt(square), turn = 2.0 * RIDDLE_PI,
                 rest = angle > 1e6 ? angle - turn * floor(angle / turn) : angle;
    *c = riddle_cos(rest), *s = riddle_sin(rest) / angle;
}
/* Returns a rotation about an axis. half: the unit axis times half the angle [rad]. */
DEM_INLINE dem_quaternion dem__turn_by(dem_vec half) {
    double c, s;
    dem__cosine_and_sine(dem__dot(half, half), &c, &s);
    return dem__quaternion(c, dem__scale(s, half));
}
/* Return a body rotated about its own first or third axis. half: half the angle [rad]. */
DEM_INLINE dem_quaternion dem__turned_about_first(dem_quaternion q, double half) {
    double c, s;
    dem__cosine_and_sine(half * half, &c, &s);
    s *= half;
    return dem__quaternion(c * q.w - s * q.x, dem_vec3(c * q.x + s * q.w, c * q.y + s * q.z, c * q.z - s * q.y));
}
DEM_INLINE dem_quaternion dem__turned_about_third(dem_quaternion q, double half) {
    double c, s;
    dem__cosine_and_sine(half * half, &c, &s);
    s *= half;
    return dem__quaternion(c * q.w - s * q.z, dem_vec3(c * q.x + s * q.y, c * q.y - s * q.x, c * q.z + s * q.w));
}

/* Rotates a free body with moments i, i, k for a time t, exactly: about the angular momentum, and about its own third
   axis. */
DEM_INLINE dem_quaternion dem__turn_top(dem_quaternion q, dem_vec momentum, double i, double k, double t) {
    const dem_quaternion turned = dem__turns(dem__turn_by(dem__scale(0.5 * t / i, momentum)), q);
    if (i == k) return turned;
    return dem__turned_about_third(turned, 0.5 * t * (1.0 / k - 1.0 / i) * dem__dot(dem__third_axis(q), momentum));
}

/* Rotates a free body with three different moments for a time t, to second order: as a symmetric top, and before and
   after that by half of the effect of the difference between the first two moments (symmetric splitting of the kinetic
   energy; Touma & Wisdom 1994). Conserves angular momentum. */
static inline dem_quaternion dem__turn_split(dem_quaternion q, dem_vec momentum, dem_vec moments, double t) {
    const double rest = 0.25 * t * (1.0 / moments.x - 1.0 / moments.y);
    q = dem__turned_about_first(q, rest * dem__dot(dem__first_axis(q), momentum));
    q = dem__turn_top(q, momentum, moments.y, moments.z, t);
    return dem__turned_about_first(q, rest * dem__dot(dem__first_axis(q), momentum));
}

/* Does the same to sixth order, in nine such steps (Kahan & Li 1997, s9odr6a). */
static inline dem_quaternion dem__turn_nine(dem_quaternion q, dem_vec momentum, dem_vec moments, double t) {
    static const double part[5] = {0.39216144400731413928, 0.33259913678935943860, -0.70624617255763935981,
                                   0.08221359629355080023, 0.79854399093482996340};
    for (int k = 0; k < 9; k++) q = dem__turn_split(q, momentum, moments, t * part[k < 5 ? k : 8 - k]);
    return dem__kept_unit(q);
}

/* Returns a time in which a body turns by at most a quarter radian [s]; HUGE_VAL at rest. */
DEM_INLINE double dem__rotation_step(dem_vec momentum, dem_vec moments) {
    const double least = moments.x < moments.y ? moments.x : moments.y,
                 smallest = least < moments.z ? least : moments.z;
    const double size = dem__length(momentum);
    return size > 0.0 ? 0.25 * smallest / size : HUGE_VAL;
}

/* Rotates a free body with three different moments for a time of a few steps, in rotation steps of at most a quarter
   radian. A body that turns too far for it, which only a forged save can hold, is left as it is. */
static inline dem_quaternion dem__turn_far(dem_quaternion q, dem_vec momentum, dem_vec moments, double t) {
    const double steps = floor(fabs(t) / dem__rotation_step(momentum, moments)) + 1.0, h = t / steps;
    if (!(steps < 1e5)) return q;
    for (double n = 0.0; n < steps; n += 1.0) q = dem__turn_nine(q, momentum, moments, h);
    return q;
}

/* Rotates a free body for a time t: in closed form if the first two moments are equal, otherwise by splitting. single:
   a step of a body under torques, to second order, like everything in such a step. */
DEM_INLINE dem_quaternion dem__turn_free(dem_quaternion q, dem_vec momentum, dem_vec moments, double t, int single) {
    if (moments.x == moments.y) return dem__turn_top(q, momentum, moments.x, moments.z, t);
    return single ? dem__turn_split(q, momentum, moments, t) : dem__turn_far(q, momentum, moments, t);
}
