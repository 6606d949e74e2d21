/* Vectors, a wall's motion in time, and the shapes of bars and cones: pure functions. */
#pragma once
#include "api.h"
#include "../../base/portable_math.h"

/* Rounds to multiples of 2e-100, which changes only numbers below 1e-68. Speeds that decay thus end at 0; neither they
   nor their squares become subnormal numbers, which make a processor slow. Two additions cost less than a comparison.
   */
DEM_INLINE double dem__flushed(double v) { return (v + DEM__LEAST) - DEM__LEAST; }
DEM_INLINE dem_vec dem__flushed_vec(dem_vec v) {
    return dem_vec3(dem__flushed(v.x), dem__flushed(v.y), dem__flushed(v.z));
}

DEM_INLINE dem_vec dem__add(dem_vec a, dem_vec b) { return dem_vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
DEM_INLINE dem_vec dem__sub(dem_vec a, dem_vec b) { return dem_vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
DEM_INLINE dem_vec dem__scale(double s, dem_vec a) { return dem_vec3(s * a.x, s * a.y, s * a.z); }
DEM_INLINE dem_vec dem__plus(dem_vec a, double s, dem_vec b) {
    return dem_vec3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
DEM_INLINE double dem__dot(dem_vec a, dem_vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
DEM_INLINE dem_vec dem__cross(dem_vec a, dem_vec b) {
    return dem_vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
DEM_INLINE double dem__length(dem_vec a) { return sqrt(dem__dot(a, a)); }

/* Returns the sine of an angle, and its cosine: the bits of riddle_sin and riddle_cos, which both find the quarter
   turn. */
static DEM__NOINLINE double dem__sine(double angle, double *cosine) {
    int quarter;
    const double r = riddle__within_quarter(angle, &quarter);
    *cosine = riddle__sin_quarter(r, quarter + 1);
    return riddle__sin_quarter(r, quarter);
}

/* Rotates v by an angle [rad] about a unit axis (Rodrigues). */
static DEM__NOINLINE dem_vec dem__rotated(dem_vec v, dem_vec axis, double angle) {
    double turns = angle / (2.0 * RIDDLE_PI), phase = 2.0 * RIDDLE_PI * (turns - floor(turns));
    double c, s = dem__sine(phase, &c);
    return dem__add(dem__add(dem__scale(c, v), dem__scale(s, dem__cross(axis, v))),
                    dem__scale((1.0 - c) * dem__dot(axis, v), axis));
}

/* Returns the displacement of a harmonic vibration from its start [m], and its velocity and acceleration. start: sine
   of the phase; angle: 2 pi times frequency and time. */
DEM_INLINE double dem__vibration(double amplitude, double phase, double start, double angle, double rate,
                                 double *velocity, double *acceleration) {
    if (amplitude == 0.0) {
        *velocity = *acceleration = 0.0;
        return 0.0;
    }
    double c, s = dem__sine(angle + phase, &c);
    *velocity = amplitude * rate * c;
    *acceleration = -amplitude * rate * rate * s;
    return amplitude * (s - start);
}

/* Sets the sines of a vibration's phases, which do not change while it lasts. */
static inline void dem__set_phase_sine(dem_wall *w) {
    const dem_vec phase = w->asked.phase;
    w->phase_sine =
        dem_vec3(riddle_sin(phase.x) + 0.0, riddle_sin(phase.y) + 0.0, riddle_sin(phase.z) + 0.0); /* no -0 */
}

/* Displacement, velocity and acceleration of a wall by vibration. */
typedef struct dem__sway {
    dem_vec shift, velocity, acceleration;
} dem__sway;
static inline dem__sway dem__sway_at(const dem_wall *w, double t) {
    const double rate = 2.0 * RIDDLE_PI * w->asked.frequency, turns = w->asked.frequency * t;
    const double angle = 2.0 * RIDDLE_PI * (turns - floor(turns));
    const dem_vec size = w->asked.amplitude, phase = w->asked.phase, start = w->phase_sine;
    dem__sway s;
    s.shift.x = dem__vibration(size.x, phase.x, start.x, angle, rate, &s.velocity.x, &s.acceleration.x);
    s.shift.y = dem__vibration(size.y, phase.y, start.y, angle, rate, &s.velocity.y, &s.acceleration.y);
    s.shift.z = dem__vibration(size.z, phase.z, start.z, angle, rate, &s.velocity.z, &s.acceleration.z);
    return s;
}

/* Returns whether two walls vibrate alike, as a deck and its side wall do. */
DEM_INLINE int dem__sways_like(const dem_wall *a, const dem_wall *b) {
    return memcmp(&a->asked.amplitude, &b->asked.amplitude, sizeof a->asked.amplitude) == 0 &&
           memcmp(&a->asked.phase, &b->asked.phase, sizeof a->asked.phase) == 0 &&
           a->asked.frequency == b->asked.frequency && a->asked.motion_start == b->asked.motion_start;
}

/* Returns the position of a wall in a pose; axis: its axes in the pose. */
static inline dem_vec dem__posed(const dem_wall *w, const dem_pose *pose, dem_vec *axis) {
    const double angle = dem__length(pose->turn);
    dem_vec arm = dem__sub(w->asked.origin, w->asked.spin_centre);
    for (int k = 0; k < 3; k++) axis[k] = w->asked.rest_axis[k];
    if (angle != 0.0) { /* true for NaN, which is passed on */
        const dem_vec about = dem__scale(1.0 / angle, pose->turn);
        for (int k = 0; k < 3; k++) axis[k] = dem__rotated(axis[k], about, angle);
        arm = dem__rotated(arm, about, angle);
    }
    return dem__add(dem__add(w->asked.spin_centre, arm), pose->shift);
}

/* Moves a prescribed wall to its place at a time. Its velocity, acceleration and spin are central differences. */
static inline void dem__prescribed_wall(dem_wall *w, double time) {
    dem_vec at[3], axis[3][3], omega = dem_vec3(0.0, 0.0, 0.0);
    const double rate = 0.5 / w->asked.interval;
    if (!w->asked.motion) return;
    for (int k = 0; k < 3; k++) {
        dem_pose pose;
        memset(&pose, 0, sizeof pose);
        w->asked.motion(w->asked.motion_user, time + (k - 1) * w->asked.interval, &pose);
        at[k] = dem__posed(w, &pose, axis[k]);
    }
    for (int k = 0; k < 3; k++) { /* omega = 1/2 sum of a x da/dt over the axes */
        w->axis[k] = axis[1][k];
        omega = dem__add(omega, dem__scale(0.5 * rate, dem__cross(axis[1][k], dem__sub(axis[2][k], axis[0][k]))));
    }
    w->position = at[1];
    w->velocity = dem__scale(rate, dem__sub(at[2], at[0]));
    w->acceleration = dem__scale(4.0 * rate * rate, dem__sub(dem__add(at[0], at[2]), dem__scale(2.0, at[1])));
    w->spin = dem__length(omega);
    if (w->spin > 0.0) w->spin_axis = dem__scale(1.0 / w->spin, omega);
}

/* Sets velocity and acceleration of a controlled wall at its present place. rate: its speed [m/s] or spin [rad/s]. */
static inline void dem__rated_wall(dem_wall *w, double rate) {
    if (w->asked.drive == DEM_FORCE_CONTROLLED) {
        w->velocity = dem__scale(rate, w->spin_axis), w->acceleration = dem__scale(w->rate_change, w->spin_axis);
        return;
    }
    const dem_vec arm = dem__sub(w->position, w->asked.spin_centre), across = dem__cross(w->spin_axis, arm);
    w->spin = rate, w->spin_rate = w->rate_change;
    w->velocity = dem__scale(rate, across);
    w->acceleration =
        dem__add(dem__scale(w->rate_change, across), dem__scale(rate, dem__cross(w->spin_axis, w->velocity)));
}

/* Moves a controlled wall to its place at a time: predicted from the last step, as a particle is. */
static inline void dem__controlled_wall(dem_wall *w, double time) {
    const double tau = time - w->asked.motion_start, way = w->coordinate + tau * (w->rate + 0.5 * tau * w->rate_change);
    dem_pose pose;
    memset(&pose, 0, sizeof pose);
    if (w->asked.drive == DEM_FORCE_CONTROLLED) pose.shift = dem__scale(way, w->spin_axis);
    else pose.turn = dem__scale(way, w->spin_axis);
    w->position = dem__posed(w, &pose, w->axis);
    dem__rated_wall(w, w->rate + tau * w->rate_change);
}

/* Moves a kinematic wall to its place t after its motion began [s]. */
static inline void dem__kinematic_wall(dem_wall *w, double t, const dem__sway *sway) {
    const dem_vec shift = dem__add(sway->shift, dem__scale(t, w->asked.drift));
    w->velocity = dem__add(sway->velocity, w->asked.drift);
    w->acceleration = sway->acceleration;
    dem_vec origin = w->asked.origin;
    if (w->spin != 0.0) {
        double angle = w->spin * t;
        for (int k = 0; k < 3; k++) w->axis[k] = dem__rotated(w->asked.rest_axis[k], w->spin_axis, angle);
        dem_vec arm = dem__rotated(dem__sub(w->asked.origin, w->asked.spin_centre), w->spin_axis, angle),
                omega = dem__scale(w->spin, w->spin_axis);
        dem_vec turning = dem__cross(omega, arm);
        origin = dem__add(w->asked.spin_centre, arm);
        w->velocity = dem__add(w->velocity, turning);
        w->acceleration = dem__add(w->acceleration, dem__cross(omega, turning));
    }
    w->position = dem__add(origin, shift);
}

/* Moves a wall to its place at a time [s]. */
static inline void dem__move_wall(dem_wall *w, double time) {
    if (w->asked.drive == DEM_PRESCRIBED) dem__prescribed_wall(w, time);
    else if (w->asked.drive != DEM_KINEMATIC) dem__controlled_wall(w, time);
    else {
        const dem__sway sway = dem__sway_at(w, time - w->asked.motion_start);
        dem__kinematic_wall(w, time - w->asked.motion_start, &sway);
    }
}

/* A place where a sphere is near a wall. */
typedef struct dem__touch {
    double gap, curvature;
    dem_vec normal; /* from the wall to the sphere */
    int32_t element;
    int32_t face; /* mesh: the triangle that has the nearest point inside its edges; -1: none */
} dem__touch;

/* The face on which a contact with a mesh rests. It is the only place touched as long as the centre is within `slack`
   of `at`, and a contact opens by less than that in a step. */
typedef struct dem__footing {
    dem_vec at;   /* in the wall's own frame */
    double slack; /* [m]; 0: search */
    int32_t face;
} dem__footing;

enum {
    DEM__TOUCHES = 4,
    DEM__NUMBERS = 16
};                      /* NUMBERS: contacts of a particle with a mesh, including those that end in this step */
#define DEM__SMOOTH 0.9 /* cosine of 26 degrees, up to which facets are one surface: a drum with 16 sides is round */

DEM_INLINE double dem__clamp(double v, double low, double high) { return v < low ? low : (v > high ? high : v); }

/* Computes the vector `from`, in (along, across, up), from the nearest point of the axis of bar `index` of a family, at
   (index - 1/2) pitch, to a centre. along: the centre's coordinate parallel to the bars; across: in the deck,
   perpendicular to them. Returns how far the surface is from that point [m]; < 0 if there is no such bar. */
DEM_INLINE double dem__reach_bar(const dem_wall *w, int family, double index, double along, double across, double up,
                                 dem_vec *from) {
    const double half = 0.5 * w->wire, bar = (index - 0.5) * (w->aperture + w->wire);
    const double side = family ? w->half_x : w->half_y, length = family ? w->half_y : w->half_x;
    const double end2 =
        w->circular ? (w->half_x - bar) * (w->half_x + bar) : length * length; /* square of its half length */
    const int beyond = !(along * along <= end2);
    const double da = !beyond ? 0.0 : along < 0.0 ? along + sqrt(end2) : along - sqrt(end2), dc = across - bar;
    *from = dem_vec3(da, dc, up);
    if (w->circular ? !(fabs(bar) < w->half_x) : !(fabs(bar) <= side)) return -1.0;
    if (w->profile == DEM_ROUND || !(up < 0.0)) return half;
    /* the flat side is as wide as the wire; its ends are round, seen from below */
    if (!beyond) {
        from->y = dc - dem__clamp(dc, -half, half);
        return 0.0;
    }
    const double out_by = sqrt(da * da + dc * dc), rest = out_by > half ? (out_by - half) / out_by : 0.0;
    from->x = rest * da, from->y = rest * dc;
    return 0.0;
}

/* Computes the touch with bar `index` of a family; its normal is in (along, across, up). Returns 0 if there is no such
   bar. */
DEM_INLINE int dem__touch_bar(const dem_wall *w, int family, double index, double along, double across, double up,
                              double radius, dem__touch *out) {
    dem_vec from;
    const double inner = dem__reach_bar(w, family, index, along, across, up, &from);
    if (!(inner >= 0.0)) return 0;
    const double distance = dem__length(from);
    out->gap = distance - inner - radius;
    out->curvature =
        1.0 / w->wire; /* of the round part everywhere: a contact's constants do not depend on where it begins */
    out->normal = dem__scale(1.0 / distance, from);
    out->element = 2 * (int32_t)index + family;
    return distance > 0.0;
}

/* Converts a vector from (along, across, up) of a family to the world's axes. */
DEM_INLINE dem_vec dem__from_bar(const dem_wall *w, int family, dem_vec v) {
    const dem_vec a = dem__scale(v.x, w->axis[family]), c = dem__scale(v.y, w->axis[1 - family]),
                  u = dem__scale(v.z, w->axis[2]);
    return dem__add(dem__add(a, c), u);
}

/* Returns the index of the first of the two nearest bars of a family; the second is the next one. Beside the deck they
   are the last two. */
DEM_INLINE double dem__nearest_bar(const dem_wall *w, int family, double across) {
    const double pitch = w->aperture + w->wire, half = family ? w->half_x : w->half_y,
                 nearest = floor(across / pitch + 0.5);
    if (fabs(across) < half - pitch) return nearest;
    const double last = floor(half / pitch + 0.5);
    return dem__clamp(nearest, 1.0 - last, last - 1.0);
}

/* Returns a lower limit of the gap of all other bars [m]. lowest: the smallest gap found, which counts where it is
   negative. */
DEM_INLINE double dem__third_bar(const dem_wall *w, double radius, double lowest) {
    const double pitch = w->aperture + w->wire, sum = radius + 0.5 * w->wire, near = lowest < 0.0 ? sum + lowest : sum;
    return sqrt(near * near + 0.75 * pitch * pitch) - sum;
}

/* Computes the touch with a frustum. Its nearest point lies in the plane of axis and centre, on a segment. d: the
   centre, from the low end; up: along the axis. Returns 0 if the gap is not below `limit`; least: the gap. */
static inline int dem__touch_cone(const dem_wall *w, dem_vec d, double up, double radius, double limit, dem__touch *out,
                                  double *least) {
    const dem_vec radial = dem__sub(d, dem__scale(up, w->axis[2]));
    const double rho = dem__length(radial), rise = w->high_radius - w->radius,
                 slant = sqrt(rise * rise + w->length * w->length);
    const dem_vec outward = rho > 0.0 ? dem__scale(1.0 / rho, radial) : w->axis[0]; /* on the axis a whole ring is
                                                                                       nearest: any point of it */
    const double along = dem__clamp(((rho - w->radius) * rise + up * w->length) / (slant * slant), 0.0, 1.0);
    const double x = rho - (w->radius + along * rise), y = up - along * w->length;
    double distance = sqrt(x * x + y * y), nx = w->length / slant, ny = -rise / slant;
    const int on_rim = !(along > 0.0 && along < 1.0);
    if (!on_rim) { /* from the side's own normal, which is accurate near the surface */
        const double side = (rho - w->radius) * nx + up * ny;
        distance = fabs(side);
        if (side < 0.0) nx = -nx, ny = -ny;
    } else if (distance > 0.0) nx = x / distance, ny = y / distance;
    *least = out[0].gap = distance - radius;
    if (!(*least < limit)) return 0;
    out[0].normal = dem__add(dem__scale(nx, outward), dem__scale(ny, w->axis[2]));
    /* that half way up: one contact type wherever a contact begins; spheres wider than the ring lie on a rim */
    out[0].curvature = on_rim ? 0.0 : (nx < 0.0 ? -1.0 : 1.0) * w->length / (slant * (w->radius + w->high_radius));
    return 1;
}
