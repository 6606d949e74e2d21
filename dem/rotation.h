/* ------------------------------------------------------------------------------------------ >>rotation */
/* Quaternions and the free rotation of a rigid body: pure functions. A quaternion turns the body's frame into the lab's; its scalar part
   comes first.
   May be changed here alone: all that keeps length and angular momentum to rounding. */
DEM_INLINE dem_quaternion dem__quaternion(double w, dem_vec v) {
    dem_quaternion q;
    q.w = w, q.x = v.x, q.y = v.y, q.z = v.z;
    return q;
}
DEM_INLINE dem_vec dem__vector_part(dem_quaternion q) { return dem_vec3(q.x, q.y, q.z); }
DEM_INLINE dem_quaternion dem__opposite_turn(dem_quaternion q) { return dem__quaternion(q.w, dem_vec3(-q.x, -q.y, -q.z)); }

/* Returns the turn b followed by the turn a. */
DEM_INLINE dem_quaternion dem__turns(dem_quaternion a, dem_quaternion b) {
    const dem_vec u = dem__vector_part(a), v = dem__vector_part(b);
    return dem__quaternion(a.w * b.w - dem__dot(u, v), dem__add(dem__plus(dem__scale(a.w, v), b.w, u), dem__cross(u, v)));
}

/* Returns a turn about an axis. half: the unit axis times half the angle [rad]. Below 0.1 rad the series is as accurate, and cheaper. */
DEM_INLINE dem_quaternion dem__turn_by(dem_vec half) {
    const double square = dem__dot(half, half);
    if (square < 0.01) {
        const double s = 1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0)));
        const double c = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)));
        return dem__quaternion(c, dem__scale(s, half));
    }
    const double angle = sqrt(square);
    return dem__quaternion(riddle_cos(angle), dem__scale(riddle_sin(angle) / angle, half));
}

/* Returns a vector of the body's frame in the lab's. */
DEM_INLINE dem_vec dem__to_lab(dem_quaternion q, dem_vec v) {
    const dem_vec u = dem__vector_part(q), t = dem__scale(2.0, dem__cross(u, v));
    return dem__add(dem__plus(v, q.w, t), dem__cross(u, t));
}
/* Returns a vector of the lab's frame in the body's. */
DEM_INLINE dem_vec dem__to_body(dem_quaternion q, dem_vec v) { return dem__to_lab(dem__opposite_turn(q), v); }

/* Removes the error of the length by rounding, with one Newton step for the inverse of the length. */
DEM_INLINE dem_quaternion dem__kept_unit(dem_quaternion q) {
    const double f = 1.5 - 0.5 * (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return dem__quaternion(f * q.w, dem__scale(f, dem__vector_part(q)));
}

/* Scales a quaternion of any length to 1. Returns 0 if it has no direction. */
static inline int dem__unit_turn(dem_quaternion q, dem_quaternion *unit) {
    const double a = fabs(q.w) > fabs(q.x) ? fabs(q.w) : fabs(q.x), b = fabs(q.y) > fabs(q.z) ? fabs(q.y) : fabs(q.z), most = a > b ? a : b;
    if (!(most > 0.0 && most <= DBL_MAX) || !(fabs(q.w) + fabs(q.x) + fabs(q.y) + fabs(q.z) >= 0.0)) return 0;
    const double w = q.w / most, x = q.x / most, y = q.y / most, z = q.z / most, f = 1.0 / sqrt(w * w + x * x + y * y + z * z);
    *unit = dem__quaternion(f * w, dem_vec3(f * x, f * y, f * z));
    return 1;
}

/* Returns the angular momentum of a spin, both in the lab's frame. */
DEM_INLINE dem_vec dem__momentum_of(dem_quaternion q, dem_vec moments, dem_vec spin) {
    const dem_vec w = dem__to_body(q, spin);
    return dem__to_lab(q, dem_vec3(moments.x * w.x, moments.y * w.y, moments.z * w.z));
}
/* Returns the spin of an angular momentum, both in the lab's frame. */
DEM_INLINE dem_vec dem__spin_of(dem_quaternion q, dem_vec moments, dem_vec momentum) {
    const dem_vec l = dem__to_body(q, momentum);
    return dem__to_lab(q, dem_vec3(l.x / moments.x, l.y / moments.y, l.z / moments.z));
}

/* Rotates a free body with moments i, i, k for a time t, exactly: about the angular momentum, and about its own third axis. */
DEM_INLINE dem_quaternion dem__turn_top(dem_quaternion q, dem_vec momentum, double i, double k, double t) {
    const dem_quaternion about = dem__turn_by(dem__scale(0.5 * t / i, momentum));
    if (i == k) return dem__turns(about, q);
    const double own = 0.5 * t * (1.0 / k - 1.0 / i) * dem__to_body(q, momentum).z;
    return dem__turns(dem__turns(about, q), dem__turn_by(dem_vec3(0.0, 0.0, own)));
}

/* Rotates a free body with three moments for a time t, to second order: as a symmetric top, and before and after for half of what the first
   moment differs from the second (symmetric splitting of the kinetic energy; Touma & Wisdom 1994). Conserves angular momentum. */
static inline dem_quaternion dem__turn_split(dem_quaternion q, dem_vec momentum, dem_vec moments, double t) {
    const double rest = 0.25 * t * (1.0 / moments.x - 1.0 / moments.y);
    q = dem__turns(q, dem__turn_by(dem_vec3(rest * dem__to_body(q, momentum).x, 0.0, 0.0)));
    q = dem__turn_top(q, momentum, moments.y, moments.z, t);
    return dem__turns(q, dem__turn_by(dem_vec3(rest * dem__to_body(q, momentum).x, 0.0, 0.0)));
}

/* Does the same to sixth order, by nine of these (Kahan & Li 1997, s9odr6a). */
static inline dem_quaternion dem__turn_nine(dem_quaternion q, dem_vec momentum, dem_vec moments, double t) {
    static const double part[5] = {0.39216144400731413928, 0.33259913678935943860, -0.70624617255763935981, 0.08221359629355080023,
                                   0.79854399093482996340};
    for (int k = 0; k < 9; k++) q = dem__turn_split(q, momentum, moments, t * part[k < 5 ? k : 8 - k]);
    return dem__kept_unit(q);
}

/* Returns a time in which a body turns by at most a quarter radian [s]; HUGE_VAL at rest. */
DEM_INLINE double dem__turn_stride(dem_vec momentum, dem_vec moments) {
    const double least = moments.x < moments.y ? moments.x : moments.y, smallest = least < moments.z ? least : moments.z;
    const double size = dem__length(momentum);
    return size > 0.0 ? 0.25 * smallest / size : HUGE_VAL;
}

/* Rotates a free body with three moments for any time, in steps of at most a quarter radian. */
static inline dem_quaternion dem__turn_far(dem_quaternion q, dem_vec momentum, dem_vec moments, double t) {
    const double steps = floor(fabs(t) / dem__turn_stride(momentum, moments)) + 1.0, h = t / steps;
    for (double n = 0.0; n < steps; n += 1.0) q = dem__turn_nine(q, momentum, moments, h);
    return q;
}

/* Rotates a free body for a time t: in closed form if the first two moments are equal, otherwise by splitting. single: a step of a body
   under torques, to second order, as everything in such a step is. */
DEM_INLINE dem_quaternion dem__turn_free(dem_quaternion q, dem_vec momentum, dem_vec moments, double t, int single) {
    if (moments.x == moments.y) return dem__turn_top(q, momentum, moments.x, moments.z, t);
    return single ? dem__turn_split(q, momentum, moments, t) : dem__turn_far(q, momentum, moments, t);
}
