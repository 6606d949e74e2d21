/* Measuring: volumes, regions, stress, fields, histograms. Reads a const world; writes the caller's arrays. */
#pragma once
#include "../base/sharp.h"
#include "branches.h"
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
        for (int k = 1; k < s->corners; k++) low[a] = fmin(low[a], s->corner[k][a]), high = fmax(high, s->corner[k][a]);
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

/* Lists the displacements of the images of the periodic box: the box itself first, then one on either side along each
   periodic axis. Returns how many. */
static inline int dem__images(const dem_world *w, dem_vec shift[27]) {
    int n = 1;
    shift[0] = dem_vec3(0.0, 0.0, 0.0);
    for (int a = 0; a < 3; a++) {
        if (!w->def.periodic[a]) continue;
        const double length = dem_axis(w->def.high, a) - dem_axis(w->def.low, a);
        for (int k = 0; k < 2 * n; k++) {
            shift[n + k] = shift[k / 2];
            *dem_axis_of(&shift[n + k], a) += k % 2 ? length : -length;
        }
        n *= 3;
    }
    return n;
}

/* Finds where particle i is counted, and its velocity there. A rigid body counts once, at its centre of mass. Returns 0
   for its other particles. */
static inline int dem__counts(const dem_world *w, ptrdiff_t i, dem_vec *at, dem_vec *v) {
    const dem__rigid *r = dem__rigid_of(w, i);
    if (r && r->first != i) return 0;
    *at = r ? dem__body_position(w, r) : dem_position(w, i);
    *v = r ? dem__plus(r->v, dem__now(w, i), r->a) : dem_velocity(w, i);
    return 1;
}

/* Returns the factor of a particle's volume: 1 for a sphere. The particles of a body may overlap; they share the body's
   volume. */
static inline double dem__filled(const dem_world *w, ptrdiff_t i) {
    const dem__rigid *r = dem__rigid_of(w, i);
    double sum = 0.0;
    for (ptrdiff_t k = 0; r && k < r->pieces; k++)
        sum += dem__sphere_mass(w, w->material[i], w->particle[r->first + k].radius);
    return r ? r->mass / sum : 1.0;
}

DEM_INLINE void dem__add_stress(double (*stress)[3], double weight, dem_vec f, dem_vec l) {
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) stress[a][b] += weight * dem_axis(f, a) * dem_axis(l, b);
    }
}

/* A region that is measured. */
typedef struct dem__measured {
    const dem_region *region;
    dem_wall inside;   /* the tree of a mesh region */
    dem_vec low, high; /* the box around the region */
    dem_vec shift[27]; /* from a particle to its images in the periodic box; the first is 0 */
    int images;
    double share; /* 1 / volume [1/m3] */
} dem__measured;

/* Returns the volume of particle i at x that is in the region; for a polyhedron, over its share of the sphere around
   it. */
static inline double dem__volume_in(const dem_world *w, const dem__measured *q, ptrdiff_t i, dem_vec x) {
    const dem_convex *s = dem__shape_of(w, i);
    const double r = w->particle[i].radius;
    if (!s) return dem__ball_in(q->region, &q->inside, x, r);
    const dem_quaternion turn = dem__turn_of_polyhedron(w, dem__rigid_of(w, i), dem__now(w, i));
    return dem__polyhedron_in(q->region, &q->inside, s, x, turn) * (4.0 / 3.0 * RIDDLE_PI * r * r * r);
}

/* Adds the volume of particle i and its images in the region, as a share of the region. */
static inline void dem__add_solid(const dem_world *w, const dem__measured *q, ptrdiff_t i, dem_measure *m) {
    const dem_vec at = dem_position(w, i), low = q->low, high = q->high;
    const double r = w->particle[i].radius, filled = dem__filled(w, i) * q->share;
    for (int image = 0; image < q->images; image++) {
        const dem_vec x = dem__add(at, q->shift[image]);
        if (x.x + r >= low.x && x.x - r <= high.x && x.y + r >= low.y && x.y - r <= high.y && x.z + r >= low.z &&
            x.z - r <= high.z)
            m->solid_fraction += dem__volume_in(w, q, i, x) * filled;
    }
}

/* Returns how many images of a point are in a region. */
static inline int dem__images_in(const dem__measured *q, dem_vec point) {
    const dem_vec low = q->low, high = q->high;
    int n = 0;
    for (int image = 0; image < q->images; image++) {
        const dem_vec c = dem__add(point, q->shift[image]);
        if (!(c.x >= low.x && c.x <= high.x && c.y >= low.y && c.y <= high.y && c.z >= low.z && c.z <= high.z))
            continue;
        n += dem__holds(q->region, &q->inside, c);
    }
    return n;
}

/* Measures number, mass, mean velocity and coordination number, and the solid fraction. */
static inline void dem__measure_bodies(const dem_world *w, const dem__measured *q, dem_measure *m) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dem_vec centre, v;
        if (!w->alive[i]) continue;
        dem__add_solid(w, q, i, m);
        for (int n = dem__counts(w, i, &centre, &v) ? dem__images_in(q, centre) : 0; n > 0; n--) {
            m->count++;
            m->mass += w->particle[i].mass;
            m->coordination += w->touching[i];
            m->velocity = dem__add(m->velocity, dem__scale(w->particle[i].mass, v));
        }
    }
    m->velocity = dem__scale(m->count > 0 ? 1.0 / m->mass : 0.0, m->velocity);
    if (m->count > 0) m->coordination /= (double)m->count;
}

/* Measures granular temperature and kinetic stress, which are relative to the mean velocity. */
static inline void dem__measure_fluctuations(const dem_world *w, const dem__measured *q, dem_measure *m) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dem_vec centre, v;
        if (!w->alive[i] || !dem__counts(w, i, &centre, &v)) continue;
        const dem_vec u = dem__sub(v, m->velocity);
        for (int n = dem__images_in(q, centre); n > 0; n--) {
            m->granular_temperature += w->particle[i].mass * dem__dot(u, u);
            dem__add_stress(m->kinetic_stress, w->particle[i].mass * q->share, u, u);
        }
    }
    m->granular_temperature *= (m->count > 0 ? 1.0 / m->mass : 0.0) / 3.0;
}

/* Measures the stress that forces of contacts and links cause. */
static inline void dem__measure_contacts(const dem_world *w, const dem__measured *q, dem_measure *m) {
    for (ptrdiff_t k = 0; k < dem__forces(w); k++) {
        dem_vec from, to, force;
        if (!dem__branch(w, k, &from, &to, &force)) continue;
        for (int image = 0; image < q->images; image++) {
            const double part =
                dem__share_in(q->region, &q->inside, dem__add(from, q->shift[image]), dem__add(to, q->shift[image]));
            if (part > 0.0) dem__add_stress(m->contact_stress, part * q->share, force, dem__sub(to, from));
        }
    }
}

DEM_API dem_status dem_measure_region(const dem_world *world, const dem_region *region, dem_measure *measure) {
    const dem_world *w = world;
    dem_measure m;
    dem__measured q;
    if (!w || !w->def.allocator.fn || !measure || !dem__is_region(region)) return DEM_BAD_ARGUMENT;
    memset(&q, 0, sizeof q);
    const dem_status status = dem__make_inside(&q.inside, w, region);
    if (status != DEM_OK) return status;
    const double volume = dem_region_volume(region);
    q.region = region, q.share = volume > 0.0 ? 1.0 / volume : (double)NAN;
    q.images = dem__images(w, q.shift);
    dem__tree_bounds(region, &q.low, &q.high);
    memset(&m, 0, sizeof m);
    dem__measure_bodies(w, &q, &m);
    dem__measure_fluctuations(w, &q, &m);
    dem__measure_contacts(w, &q, &m);
    if (q.inside.tree) w->def.allocator.fn(w->def.allocator.user, q.inside.tree, q.inside.tree->bytes, 0);
    *measure = m;
    return DEM_OK;
}

static inline int dem__are_cells(const dem_cells *c) {
    double number = 1.0;
    if (!c || !dem__finite_vec(c->low) || !dem__finite_vec(c->high)) return 0;
    for (int a = 0; a < 3; a++) {
        if (c->n[a] < 1 || c->n[a] > 100000 || !(dem_axis(c->high, a) > dem_axis(c->low, a)) ||
            !dem__not_negative(c->width[a]))
            return 0;
        number *= c->n[a];
    }
    return number < 1073741824.0;
}

/* Returns the integral of the coarse-graining kernel up to u. */
DEM_INLINE double dem__up_to(double u) {
    u = dem__clamp(u, -1.0, 1.0);
    return 0.5 + 0.0625 * u * (15.0 - u * u * (10.0 - 3.0 * u * u));
}

/* Finds the cells along an axis in which a point at v counts, from first to last. Returns 0 if there are none. */
static inline int dem__cells_of(const dem_cells *c, int a, double v, int *first, int *last) {
    const double low = dem_axis(c->low, a), high = dem_axis(c->high, a), inverse = c->n[a] / (high - low),
                 reach = c->width[a];
    if (!(v + reach >= low && v - reach <= high)) return 0;
    const double from = floor((v - reach - low) * inverse), to = floor((v + reach - low) * inverse),
                 most = (double)(c->n[a] - 1);
    *first = from > 0.0 ? (int)(from < most ? from : most) : 0,
    *last = to > 0.0 ? (int)(to < most ? to : most) : 0; /* true for NaN, too */
    return 1;
}

/* Returns the share of a point at v that counts in cell k of an axis. */
DEM_INLINE double dem__share_of(const dem_cells *c, int a, int k, double v) {
    if (c->width[a] == 0.0) return 1.0;
    const double low = dem_axis(c->low, a), size = (dem_axis(c->high, a) - low) / c->n[a], at = low + k * size - v,
                 inverse = 1.0 / c->width[a];
    return dem__up_to((at + size) * inverse) - dem__up_to(at * inverse);
}

/* What a point adds to the cells around it. */
typedef struct dem__load {
    double mass, stress;            /* mass of a sphere [kg]; weight of a point on a branch */
    dem_vec velocity, force, along; /* velocity of a sphere; force of a branch, and the branch vector */
} dem__load;

/* Adds what a point and its images carry to the cells around them. */
static inline void dem__coarse_grain(const dem_world *w, const dem_cells *c, dem_field *field, dem_vec at,
                                     const dem__load *load) {
    dem_vec shift[27];
    const int images = dem__images(w, shift);
    for (int image = 0; image < images; image++) {
        int first[3], last[3];
        const dem_vec x = dem__add(at, shift[image]);
        if (!dem__cells_of(c, 0, x.x, &first[0], &last[0]) || !dem__cells_of(c, 1, x.y, &first[1], &last[1]) ||
            !dem__cells_of(c, 2, x.z, &first[2], &last[2]))
            continue;
        for (int kz = first[2]; kz <= last[2]; kz++) {
            const double sz = dem__share_of(c, 2, kz, x.z);
            for (int ky = first[1]; ky <= last[1]; ky++) {
                const double sy = sz * dem__share_of(c, 1, ky, x.y);
                for (int kx = first[0]; kx <= last[0]; kx++) {
                    const double share = sy * dem__share_of(c, 0, kx, x.x), mass = share * load->mass;
                    dem_field *f = &field[((ptrdiff_t)kz * c->n[1] + ky) * c->n[0] + kx];
                    f->density += mass;
                    f->momentum = dem__add(f->momentum, dem__scale(mass, load->velocity));
                    if (load->mass > 0.0) dem__add_stress(f->kinetic_stress, mass, load->velocity, load->velocity);
                    else dem__add_stress(f->contact_stress, share * load->stress, load->force, load->along);
                }
            }
        }
    }
}

DEM_API dem_status dem_coarse_grain(const dem_world *world, const dem_cells *cells, dem_field *field) {
    static const double node[4] = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674, 0.96028985649753623};
    static const double weight[4] = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447,
                                     0.10122853629037626};
    const dem_world *w = world;
    const dem_cells *c = cells;
    dem__load load;
    if (!w || !w->def.allocator.fn || !field || !dem__are_cells(c)) return DEM_BAD_ARGUMENT;
    const ptrdiff_t number = (ptrdiff_t)c->n[0] * c->n[1] * c->n[2];
    const double volume = (c->high.x - c->low.x) * (c->high.y - c->low.y) * (c->high.z - c->low.z) / (double)number;
    memset(field, 0, (size_t)number * sizeof *field);
    memset(&load, 0, sizeof load);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        dem_vec at;
        load.mass = w->particle[i].mass;
        if (dem__counts(w, i, &at, &load.velocity)) dem__coarse_grain(w, c, field, at, &load);
    }
    memset(&load, 0, sizeof load);
    for (ptrdiff_t k = 0; k < dem__forces(w); k++) {
        dem_vec from, to;
        if (!dem__branch(w, k, &from, &to, &load.force)) continue;
        load.along = dem__sub(to, from);
        for (int p = 0; p < 8; p++) {
            const double at = 0.5 + (p < 4 ? -0.5 : 0.5) * node[p % 4];
            load.stress = 0.5 * weight[p % 4];
            dem__coarse_grain(w, c, field, dem__add(from, dem__scale(at, load.along)), &load);
        }
    }
    for (ptrdiff_t k = 0; k < number; k++) {
        dem_field *f = &field[k];
        if (f->density > 0.0) dem__add_stress(f->kinetic_stress, -1.0 / f->density, f->momentum, f->momentum);
        f->density /= volume;
        f->momentum = dem__scale(1.0 / volume, f->momentum);
        for (int a = 0; a < 9; a++)
            f->contact_stress[a / 3][a % 3] /= volume, f->kinetic_stress[a / 3][a % 3] /= volume;
    }
    return DEM_OK;
}

static inline double dem__quantity_of(const dem_contact_info *c, dem_quantity quantity) {
    if (quantity == DEM_CONTACT_FORCE) return dem__length(c->force);
    if (quantity == DEM_CONTACT_OVERLAP) return -c->gap;
    return dem__length(dem__plus(c->force, -dem__dot(c->force, c->normal), c->normal));
}

DEM_API ptrdiff_t dem_histogram(const dem_world *world, dem_quantity quantity, double low, double high, int bins,
                                double *count) {
    const dem_world *w = world;
    ptrdiff_t outside = 0;
    if (!w || !w->def.allocator.fn || !count || bins < 1 || !(low < high) || !dem__finite(high - low))
        return -(ptrdiff_t)DEM_BAD_ARGUMENT;
    if (quantity != DEM_CONTACT_FORCE && quantity != DEM_CONTACT_OVERLAP && quantity != DEM_CONTACT_TANGENTIAL_FORCE)
        return -(ptrdiff_t)DEM_BAD_ARGUMENT;
    for (int k = 0; k < bins; k++) count[k] = 0.0;
    for (ptrdiff_t k = 0; k < w->engine->contacts.count; k++) {
        const dem_contact_info c = dem_get_contact(w, k);
        if (!(c.gap < 0.0)) continue;
        const double value = dem__quantity_of(&c, quantity), bin = floor((value - low) / (high - low) * bins);
        if (value >= low && value <= high) count[bin < (double)bins ? (int)bin : bins - 1] += 1.0;
        else outside++;
    }
    return outside;
}

DEM_API dem_status dem_residence(const dem_world *world, const dem_region *region, ptrdiff_t n, double *entered,
                                 double *stayed) {
    const dem_world *w = world;
    if (!w || !w->def.allocator.fn || !dem__is_region(region) || n < 0 || (n > 0 && (!entered || !stayed)))
        return DEM_BAD_ARGUMENT;
    for (ptrdiff_t k = 0; k < w->passed_count; k++) {
        const dem_passed *p = &w->passed[k];
        if (p->id >= (uint64_t)n || !dem__finite(entered[p->id])) continue;
        stayed[p->id] += p->time - entered[p->id];
        entered[p->id] = (double)NAN;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const uint64_t id = w->id[i];
        dem_vec at, v;
        if (!w->alive[i] || id >= (uint64_t)n || !dem__counts(w, i, &at, &v)) continue;
        const int inside = dem_region_holds(region, at), was = dem__finite(entered[id]);
        if (was && !inside) stayed[id] += w->time - entered[id];
        if (was != inside) entered[id] = inside ? w->time : (double)NAN;
    }
    return DEM_OK;
}
