/* Mass properties of bodies made of spheres, as dem_make_clump promises them. */
#pragma once
#include "rigid.h"
#include "union.h"

static inline void dem__add_content(dem__content *c, double weight, double volume, dem_vec at, dem_vec spread) {
    const double v = weight * volume;
    c->volume += v;
    c->first = dem__plus(c->first, v, at);
    c->second[0] += v * (at.x * at.x + spread.x), c->second[1] += v * (at.y * at.y + spread.y),
        c->second[2] += v * (at.z * at.z + spread.z);
    c->second[3] += v * at.x * at.y, c->second[4] += v * at.y * at.z, c->second[5] += v * at.z * at.x;
}

/* Adds a sphere, exactly: its mean square along an axis is r^2/5. */
static inline void dem__add_ball(dem__content *c, double weight, dem_vec at, double r) {
    const double spread = 0.2 * r * r;
    dem__add_content(c, weight, 4.0 / 3.0 * RIDDLE_PI * r * r * r, at, dem_vec3(spread, spread, spread));
}

/* Returns the first position on a line beyond x at which a sphere begins or ends, or two surfaces meet; HUGE_VAL if
   there is none. */
static inline double dem__next_end(int n, const double *at, const double *radius, double x) {
    double next = HUGE_VAL;
    for (int i = 0; i < n; i++) {
        const double begin = at[i] - radius[i], end = at[i] + radius[i];
        next = begin > x && begin < next ? begin : next;
        next = end > x && end < next ? end : next;
        for (int j = 0; j < i; j++) {
            const double meet =
                0.5 * (at[i] + at[j] + (radius[j] * radius[j] - radius[i] * radius[i]) / (at[i] - at[j]));
            if (at[i] != at[j] && meet > x && meet < next) next = meet;
        }
    }
    return next;
}

/* Adds spheres whose centres lie on a line from `from` along the unit vector u: a body of revolution. Its squared
   radius is the greatest of several parabolas in x. Between the positions where another one becomes the greatest, the
   integrands are polynomials, which Gauss's rule with five points integrates exactly. */
static inline void dem__add_revolution(dem__content *c, int n, const double *at, const double *radius, dem_vec from,
                                       dem_vec u) {
    static const double node[5] = {-0.90617984593866399, -0.53846931010568309, 0.0, 0.53846931010568309,
                                   0.90617984593866399};
    static const double weight[5] = {0.23692688505618909, 0.47862867049936647, 0.56888888888888889, 0.47862867049936647,
                                     0.23692688505618909};
    double begin = dem__next_end(n, at, radius, -HUGE_VAL);
    for (double end; (end = dem__next_end(n, at, radius, begin)) < HUGE_VAL; begin = end) {
        const double half = 0.5 * (end - begin), middle = 0.5 * (end + begin);
        for (int g = 0; g < 5; g++) {
            const double x = middle + half * node[g];
            double square = 0.0;
            for (int i = 0; i < n; i++) {
                const double s = radius[i] * radius[i] - (x - at[i]) * (x - at[i]);
                square = s > square ? s : square;
            }
            const double q = 0.25 * square; /* mean square of a disc along its diameter */
            dem__add_content(c, half * weight[g], RIDDLE_PI * square, dem__plus(from, x, u),
                             dem_vec3(q * (1.0 - u.x * u.x), q * (1.0 - u.y * u.y), q * (1.0 - u.z * u.z)));
            c->second[3] -= half * weight[g] * RIDDLE_PI * square * q * u.x * u.y;
            c->second[4] -= half * weight[g] * RIDDLE_PI * square * q * u.y * u.z;
            c->second[5] -= half * weight[g] * RIDDLE_PI * square * q * u.z * u.x;
        }
    }
}

/* Returns the principal moments of a symmetric tensor t = xx, yy, zz, xy, yz, zx, by Jacobi's rotations; axes: the
   principal axes. A diagonal tensor is left as it is. */
static inline dem_vec dem__clump_axes(const double *t, dem_quaternion *axes) {
    double a[3][3] = {{t[0], t[3], t[5]}, {t[3], t[1], t[4]}, {t[5], t[4], t[2]}};
    dem_quaternion q = dem__quaternion(1.0, dem_vec3(0.0, 0.0, 0.0));
    for (int sweep = 0; sweep < 60; sweep++) {
        const int p = sweep % 3, r = (p + 1) % 3, o = (p + 2) % 3;
        const double least = 1e-15 * (fabs(a[0][0]) + fabs(a[1][1]) + fabs(a[2][2]));
        if (!(fabs(a[p][r]) > least)) continue;
        const double theta = 0.5 * (a[r][r] - a[p][p]) / a[p][r];
        const double tangent = (theta >= 0.0 ? 1.0 : -1.0) / (fabs(theta) + sqrt(theta * theta + 1.0));
        const double c = 1.0 / sqrt(tangent * tangent + 1.0), s = tangent * c, app = a[p][p], arr = a[r][r],
                     apo = a[p][o], aro = a[r][o];
        a[p][p] = app - tangent * a[p][r], a[r][r] = arr + tangent * a[p][r], a[p][r] = a[r][p] = 0.0;
        a[p][o] = a[o][p] = c * apo - s * aro, a[r][o] = a[o][r] = s * apo + c * aro;
        /* new axes: e_p' = c e_p - s e_r, e_r' = s e_p + c e_r: a rotation about e_o by -angle */
        const double half_c = sqrt(0.5 * (1.0 + c)), half_s = -0.5 * s / half_c;
        q = dem__turns(
            q, dem__quaternion(half_c, dem_vec3(o == 0 ? half_s : 0.0, o == 1 ? half_s : 0.0, o == 2 ? half_s : 0.0)));
    }
    *axes = dem__kept_unit(q);
    return dem_vec3(a[0][0], a[1][1], a[2][2]);
}

/* Makes moments equal that differ by less than their accuracy, because free rotation is then exact. */
static inline void dem__merge_moments(dem_vec *moments, double known) {
    double *m[3] = {&moments->x, &moments->y, &moments->z};
    for (int k = 0; k < 3; k++) {
        double *a = m[k], *b = m[(k + 1) % 3];
        if (fabs(*a - *b) <= known * *a) *a = *b = 0.5 * (*a + *b);
    }
    if (fabs(moments->x - moments->y) <= known * moments->x && fabs(moments->y - moments->z) <= known * moments->x)
        moments->x = moments->y = moments->z = (moments->x + moments->y + moments->z) / 3.0;
}

/* Returns whether all centres lie on a line. u: its direction; at: their positions on it, from the first centre. */
static inline int dem__are_on_a_line(int n, const dem_vec *centre, double size, dem_vec *u, double *at) {
    double most = 0.0;
    *u = dem_vec3(1.0, 0.0, 0.0);
    for (int k = 1; k < n; k++) {
        const dem_vec d = dem__sub(centre[k], centre[0]);
        const double length = dem__length(d);
        if (length > most) most = length, *u = dem__scale(1.0 / length, d);
    }
    for (int k = 0; k < n; k++) {
        const dem_vec d = dem__sub(centre[k], centre[0]);
        at[k] = dem__dot(d, *u);
        if (!(dem__length(dem__plus(d, -at[k], *u)) <= 1e-12 * size)) return 0;
    }
    return 1;
}

/* Removes spheres inside another one, which touch nothing. Returns how many remain, in their order. */
static inline int dem__drop_inner(int n, dem_vec *centre, double *radius) {
    int kept = 0;
    for (int k = 0; k < n; k++) {
        int inner = 0;
        for (int o = 0; o < n && !inner; o++) {
            const int twin = radius[o] == radius[k] && o > k; /* of equal spheres the first stays */
            inner =
                o != k && !twin && dem__length(dem__sub(centre[o], centre[k])) + radius[k] <= (1.0 + 1e-12) * radius[o];
        }
        if (!inner) centre[kept] = centre[k], radius[kept++] = radius[k];
    }
    return kept;
}

DEM_API dem_status dem_make_clump(int n, const double *centres, const double *diameters, dem_clump *clump) {
    dem_clump c;
    dem__content content;
    double size = 0.0, at[DEM_CLUMP_MAX];
    int order[3];
    dem_vec u;
    if (!centres || !diameters || !clump || n < 1) return DEM_BAD_ARGUMENT;
    if (n > DEM_CLUMP_MAX) return DEM_TOO_MANY;
    memset(&c, 0, sizeof c), memset(&content, 0, sizeof content);
    for (int k = 0; k < n; k++) {
        const dem_vec x = dem_vec3(centres[3 * k], centres[3 * k + 1], centres[3 * k + 2]);
        if (!(diameters[k] >= 1e-30 && diameters[k] <= 1e30) || !(dem__length(x) <= 1e30)) return DEM_BAD_ARGUMENT;
        c.radius[k] = 0.5 * diameters[k], c.centre[k] = x;
        const double extent = dem__length(dem__sub(x, c.centre[0])) + c.radius[k];
        size = extent > size ? extent : size;
    }
    const dem_vec from =
        c.centre[0]; /* moments about a point inside, with lengths over the size, so that no number overflows */
    for (int k = 0; k < n; k++) c.centre[k] = dem__scale(1.0 / size, dem__sub(c.centre[k], from)), c.radius[k] /= size;
    c.spheres = dem__drop_inner(n, c.centre, c.radius);
    const int line = dem__are_on_a_line(c.spheres, c.centre, 1.0, &u, at);
    if (c.spheres == 1) dem__add_ball(&content, 1.0, c.centre[0], c.radius[0]);
    else if (line) dem__add_revolution(&content, c.spheres, at, c.radius, c.centre[0], u);
    else dem__add_union(&content, c.spheres, c.centre, c.radius);
    const double v = content.volume, *s = content.second;
    const dem_vec m = dem__scale(1.0 / v, content.first);
    const double xx = s[0] - v * m.x * m.x, yy = s[1] - v * m.y * m.y, zz = s[2] - v * m.z * m.z;
    const double tensor[6] = {
        yy + zz, zz + xx, xx + yy, v * m.x * m.y - s[3], v * m.y * m.z - s[4], v * m.z * m.x - s[5]};
    c.moments = dem__clump_axes(tensor, &c.axes);
    dem__merge_moments(&c.moments, c.spheres == 1 || line ? 1e-12 : 1e-9);
    dem__order_moments(&c.moments, &c.axes, order);
    for (int k = 0; k < c.spheres; k++) c.centre[k] = dem__scale(size, dem__sub(c.centre[k], m)), c.radius[k] *= size;
    c.origin = dem__plus(from, size, m);
    c.volume = v * size * size * size;
    c.moments = dem__scale(size * size * size * size * size, c.moments);
    if (!dem__positive(c.volume) || !dem__positive(c.moments.x) || !dem__positive(c.moments.y) ||
        !dem__positive(c.moments.z))
        return DEM_BAD_ARGUMENT;
    c.add__ = dem_add_clumps;
    *clump = c;
    return DEM_OK;
}

DEM_API dem_status dem_make_capsule(dem_clump *clump, double diameter, double length) {
    double centre[DEM_CLUMP_MAX][3], width[DEM_CLUMP_MAX];
    if (!clump || !dem__positive(diameter) || !(length >= diameter && length <= DBL_MAX)) return DEM_BAD_ARGUMENT;
    const double spheres = 1.0 + ceil((length - diameter) / (0.141 * diameter)); /* (s/2)^2 = r^2 - (0.99 r)^2 */
    if (!(spheres <= (double)DEM_CLUMP_MAX)) return DEM_TOO_MANY;
    const int n = (int)spheres;
    for (int k = 0; k < n; k++) {
        centre[k][0] = n > 1 ? (length - diameter) * ((double)k / (double)(n - 1) - 0.5) : 0.0;
        centre[k][1] = centre[k][2] = 0.0, width[k] = diameter;
    }
    return dem_make_clump(n, centre[0], width, clump);
}
