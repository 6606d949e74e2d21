/* How much of a ball, a polyhedron or a line is within a region. Pure functions of the region and the shape. */
#pragma once
#include "../base/sharp.h"
#include "../feed/sources.h"

/* Returns the volume of the unit ball where z > c. */
DEM_INLINE double dem__cap(double c) { return RIDDLE_PI / 3.0 * (1.0 - c) * (1.0 - c) * (2.0 + c); }
DEM_INLINE double dem__acos(double x) { return riddle_acos(dem__clamp(x, -1.0, 1.0)); }
DEM_INLINE double dem__root(double x) { return x > 0.0 ? sqrt(x) : 0.0; }

/* Returns the volume of the unit ball where y > b and z > c; b, c in [-1, 1]. */
static inline double dem__wedge(double b, double c) {
    if (b < 0.0) return dem__cap(c) - dem__wedge(-b, c);
    if (c < 0.0) return dem__cap(b) - dem__wedge(b, -c);
    if (!(b * b + c * c < 1.0)) return 0.0;
    const double rb = sqrt(1.0 - b * b), rc = sqrt(1.0 - c * c),
                 half = dem__root(1.0 - b * b - c * c); /* half length of the edge inside */
    /* half the angles of the arcs on the two circles */
    const double at_b = dem__acos(c / rb), at_c = dem__acos(b / rc);
    const double sphere = 2.0 * (RIDDLE_PI - b * at_b - c * at_c - dem__acos(-b * c / (rb * rc)));
    return (sphere - b * (rb * rb * at_b - c * half) - c * (rc * rc * at_c - b * half)) / 3.0;
}

/* Returns the area of the face x = a of dem__corner. arc: the angle of its arc. */
static inline double dem__corner_face(double a, double b, double c, double *arc) {
    const double square = 1.0 - a * a, r = sqrt(square);
    *arc = dem__acos(b / r) - (0.5 * RIDDLE_PI - dem__acos(c / r));
    return 0.5 * (square * *arc - c * (dem__root(square - c * c) - b) - b * (dem__root(square - b * b) - c));
}

/* Returns the volume of the unit ball where x > a, y > b and z > c, each in [-1, 1]. */
static inline double dem__corner(double a, double b, double c) {
    if (a < 0.0) return dem__wedge(b, c) - dem__corner(-a, b, c);
    if (b < 0.0) return dem__wedge(a, c) - dem__corner(a, -b, c);
    if (c < 0.0) return dem__wedge(a, b) - dem__corner(a, b, -c);
    if (!(a * a + b * b + c * c < 1.0)) return 0.0;
    double arc[3];
    const double ra = sqrt(1.0 - a * a), rb = sqrt(1.0 - b * b), rc = sqrt(1.0 - c * c);
    const double face_a = dem__corner_face(a, b, c, &arc[0]), face_b = dem__corner_face(b, c, a, &arc[1]),
                 face_c = dem__corner_face(c, a, b, &arc[2]);
    const double turns = dem__acos(-a * b / (ra * rb)) + dem__acos(-b * c / (rb * rc)) + dem__acos(-c * a / (rc * ra));
    const double sphere = 2.0 * RIDDLE_PI - a * arc[0] - b * arc[1] - c * arc[2] - turns;
    return (sphere - a * face_a - b * face_b - c * face_c) / 3.0;
}

DEM_API double dem_ball_in_box(double radius, dem_vec low, dem_vec high) {
    double sum = 0.0, side[2][3];
    if (!dem__positive(radius) || !(low.x <= high.x && low.y <= high.y && low.z <= high.z)) return (double)NAN;
    for (int a = 0; a < 3; a++) {
        side[0][a] = dem__clamp(dem_axis(low, a) / radius, -1.0, 1.0);
        side[1][a] = dem__clamp(dem_axis(high, a) / radius, -1.0, 1.0);
    }
    for (int k = 0; k < 8; k++) {
        const int x = k & 1, y = k >> 1 & 1, z = k >> 2;
        sum += ((x + y + z) & 1 ? -1.0 : 1.0) * dem__corner(side[x][0], side[y][1], side[z][2]);
    }
    return sum > 0.0 ? sum * radius * radius * radius : 0.0;
}

/* Returns the area that two discs of radii q and r have in common, whose centres are `apart`. */
static inline double dem__discs(double q, double r, double apart) {
    const double smaller = q < r ? q : r;
    if (apart <= fabs(q - r)) return RIDDLE_PI * smaller * smaller;
    if (!(apart < q + r)) return 0.0;
    const double at_q = (apart * apart + q * q - r * r) / (2.0 * apart), at_r = apart - at_q;
    return q * q * dem__acos(at_q / q) + r * r * dem__acos(at_r / r) - apart * dem__root(q * q - at_q * at_q);
}

/* Returns whether a region contains a point. inside: the tree of a mesh region. */
static inline int dem__holds(const dem_region *r, const dem_wall *inside, dem_vec point) {
    return r->kind == DEM_REGION_MESH ? dem__is_inside_wall(inside, point) : dem_region_holds(r, point);
}

/* Returns the volume of a ball within a mesh. If the surface cuts the ball, counts the points of a grid that are
   inside. */
static inline double dem__ball_in_mesh(const dem_wall *inside, dem_vec centre, double radius) {
    const int points = 10;
    const double whole = 4.0 / 3.0 * RIDDLE_PI * radius * radius * radius;
    dem__touch touch[DEM__TOUCHES];
    double least;
    int all = 0, in = 0;
    if (dem__touch_wall(inside, centre, radius, 0.0, touch, &least) == 0)
        return dem__is_inside_wall(inside, centre) ? whole : 0.0;
    for (int k = 0; k < points * points * points; k++) {
        const double step = 2.0 * radius / points, x = (k % points + 0.5) * step - radius,
                     y = (k / points % points + 0.5) * step - radius, z = (k / (points * points) + 0.5) * step - radius;
        if (x * x + y * y + z * z > radius * radius) continue;
        all++;
        in += dem__is_inside_wall(inside, dem__add(centre, dem_vec3(x, y, z)));
    }
    return whole * in / all;
}

/* Returns the share of the line from a to b that lies in a mesh, by counting points. */
static inline double dem__share_in_mesh(const dem_wall *inside, dem_vec a, dem_vec b) {
    const int points = 64;
    const dem_vec way = dem__sub(b, a);
    dem__touch touch[DEM__TOUCHES];
    double least;
    int in = 0;
    if (dem__touch_wall(inside, dem__plus(a, 0.5, way), 0.5 * dem__length(way), 0.0, touch, &least) == 0)
        return dem__is_inside_wall(inside, a) ? 1.0 : 0.0;
    for (int k = 0; k < points; k++) in += dem__is_inside_wall(inside, dem__plus(a, (k + 0.5) / points, way));
    return (double)in / points;
}

/* Returns the volume of a ball within a region. */
static inline double dem__ball_in(const dem_region *r, const dem_wall *inside, dem_vec centre, double radius) {
    const dem_vec d = dem__sub(centre, r->low);
    if (r->kind == DEM_REGION_MESH) return dem__ball_in_mesh(inside, centre, radius);
    const double whole = 4.0 / 3.0 * RIDDLE_PI * radius * radius * radius;
    if (r->kind == DEM_REGION_BOX) return dem_ball_in_box(radius, dem__sub(r->low, centre), dem__sub(r->high, centre));
    if (r->kind == DEM_REGION_SPHERE) {
        const double apart = dem__length(d), sum = r->radius + radius, deep = sum - apart, less = r->radius - radius;
        if (apart <= fabs(less)) return less > 0.0 ? whole : dem_region_volume(r);
        return deep > 0.0
                   ? RIDDLE_PI * deep * deep * (apart * apart + 2.0 * apart * sum - 3.0 * less * less) / (12.0 * apart)
                   : 0.0;
    }
    dem_vec axis = d;
    dem__unit(r->axis, &axis);
    const double along = dem__dot(d, axis), apart = dem__root(dem__dot(d, d) - along * along);
    if (apart + radius <= r->radius && along >= radius && along <= r->length - radius) return whole;
    if (apart >= r->radius + radius) return 0.0;
    /* slices across the axis, evenly spaced in the angle, so that the ends of the ball are smooth */
    const double from = dem__acos(dem__clamp(along / radius, -1.0, 1.0)),
                 to = dem__acos(dem__clamp((along - r->length) / radius, -1.0, 1.0));
    const int slices = 128;
    double sum = 0.0;
    for (int k = 0; k < slices; k++) {
        const double s = riddle_sin(from + (to - from) * (k + 0.5) / slices);
        sum += s * dem__discs(radius * s, r->radius, apart);
    }
    return sum * radius * (to - from) / slices;
}

/* Returns the share of a polyhedron without its rounding that lies in a box; closed form. */
static inline double dem__share_in_box(const dem_convex *s, dem_vec centre, dem_quaternion turn, dem_vec low,
                                       dem_vec high) {
    double plane[DEM__PLANES_MAX][4];
    dem__sharp_planes(s, plane);
    const double whole = dem__volume_behind((const double(*)[4])plane, s->faces, s->reach);
    for (int k = 0; k < 6; k++) {
        const int a = k / 2;
        const double side = k % 2 ? 1.0 : -1.0;
        const dem_vec n = dem__to_body(turn, dem_vec3(a == 0 ? side : 0.0, a == 1 ? side : 0.0, a == 2 ? side : 0.0));
        double *p = plane[s->faces + k];
        p[0] = n.x, p[1] = n.y, p[2] = n.z;
        p[3] = side * (dem_axis(k % 2 ? high : low, a) - dem_axis(centre, a));
    }
    return dem__volume_behind((const double(*)[4])plane, s->faces + 6, s->reach) / whole;
}

/* Returns the share of a polyhedron that lies in a region. Where the region's surface cuts the sphere around it, and is
   no box, counts those of 4096 points in the polyhedron (Roberts's sequence) that are in the region. */
static inline double dem__polyhedron_in(const dem_region *r, const dem_wall *inside, const dem_convex *s,
                                        dem_vec centre, dem_quaternion turn) {
    static const double next[3] = {0.81917251339616443, 0.67104360670378920, 0.54970047790197026};
    const double ball = 4.0 / 3.0 * RIDDLE_PI * s->reach * s->reach * s->reach,
                 part = dem__ball_in(r, inside, centre, s->reach) / ball;
    double low[3], wide[3], u[3] = {0.5, 0.5, 0.5};
    int all = 0, in = 0;
    if (!(part > 0.0)) return 0.0;
    if (part >= 1.0 - 1e-12) return 1.0;
    if (r->kind == DEM_REGION_BOX) return dem__share_in_box(s, centre, turn, r->low, r->high);
    for (int a = 0; a < 3; a++) {
        double high = low[a] = s->corner[0][a];
        for (int k = 1; k < s->corners; k++) {
            const double x = s->corner[k][a];
            low[a] = x < low[a] ? x : low[a], high = x > high ? x : high;
        }
        low[a] -= s->radius, wide[a] = high + s->radius - low[a];
    }
    for (int tries = 0; tries < 1 << 16 && all < 4096; tries++) {
        int f = 0;
        for (int a = 0; a < 3; a++) u[a] += next[a] - (u[a] + next[a] >= 1.0 ? 1.0 : 0.0);
        const dem_vec x = dem_vec3(low[0] + u[0] * wide[0], low[1] + u[1] * wide[1], low[2] + u[2] * wide[2]);
        while (f < s->faces && dem__dot(dem__point(s->plane[f]), x) <= s->plane[f][3] + s->radius) f++;
        if (f < s->faces) continue;
        all++, in += dem__holds(r, inside, dem__add(centre, dem__to_lab(turn, x)));
    }
    return all > 0 ? (double)in / all : part;
}

/* Returns the share of the line from a to b that lies in a region. */
static inline double dem__share_in(const dem_region *r, const dem_wall *inside, dem_vec a, dem_vec b) {
    if (r->kind == DEM_REGION_MESH) return dem__share_in_mesh(inside, a, b);
    const dem_vec way = dem__sub(b, a), d = dem__sub(a, r->low);
    double from = 0.0, to = 1.0;
    if (r->kind == DEM_REGION_BOX) {
        for (int k = 0; k < 3; k++) {
            const double at = dem_axis(a, k), v = dem_axis(way, k), low = dem_axis(r->low, k) - at,
                         high = dem_axis(r->high, k) - at;
            if (v == 0.0 && !(low <= 0.0 && high >= 0.0)) return 0.0;
            if (v == 0.0) continue;
            const double first = (v > 0.0 ? low : high) / v, last = (v > 0.0 ? high : low) / v;
            from = first > from ? first : from, to = last < to ? last : to;
        }
        return to > from ? to - from : 0.0;
    }
    dem_vec p = d, v = way;
    if (r->kind == DEM_REGION_CYLINDER) {
        dem_vec axis = d;
        dem__unit(r->axis, &axis);
        const double at = dem__dot(d, axis), up = dem__dot(way, axis);
        if (up == 0.0 && !(at >= 0.0 && at <= r->length)) return 0.0;
        if (up != 0.0) {
            const double first = (up > 0.0 ? -at : r->length - at) / up, last = (up > 0.0 ? r->length - at : -at) / up;
            from = first > from ? first : from, to = last < to ? last : to;
        }
        p = dem__sub(p, dem__scale(at, axis)), v = dem__sub(v, dem__scale(up, axis));
    }
    const double square = dem__dot(v, v), half = dem__dot(p, v), rest = dem__dot(p, p) - r->radius * r->radius;
    if (!(square > 0.0)) return rest <= 0.0 && to > from ? to - from : 0.0;
    const double root = half * half - square * rest;
    if (!(root > 0.0)) return 0.0;
    const double first = (-half - sqrt(root)) / square, last = (-half + sqrt(root)) / square;
    from = first > from ? first : from, to = last < to ? last : to;
    return to > from ? to - from : 0.0;
}
