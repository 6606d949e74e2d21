/* Volume and moments of a union of balls, from its surface (Gauss's theorem): pure functions. Each ball's surface is
   cut along latitudes about z. On a latitude other balls cover arcs. Between the arcs, the integrals of products of the
   normal's components are closed forms. Between latitudes at which an arc begins or ends, they are smooth functions of
   the latitude but for square roots at both ends. A substitution removes these, so that Gauss's rule with 16 points is
   exact to rounding. */
#pragma once
#include "../motion/rotation.h"
#include "../../base/portable_math.h"

/* Volume [m3], its first moments [m4] and second moments about the origin [m5]: xx, yy, zz, xy, yz, zx. */
typedef struct dem__content {
    double volume;
    dem_vec first;
    double second[6];
} dem__content;

/* Integrals over the exposed directions n of a ball: of 1, n, n n, n n n. */
typedef struct dem__exposed {
    double zero, one[3], two[3][3], three[3][3][3];
} dem__exposed;

/* What another ball covers of a ball's surface: directions n with n d > h. */
typedef struct dem__cover {
    dem_vec d;
    double h, across, angle; /* across, angle: length and angle of d about z */
} dem__cover;

/* Rims of m caps meet in at most 6 m - 12 exposed places, and each cap has two ends. Where many meet in one place,
   rounding may find some more. A latitude that does not fit is only a kink, which halving a zone resolves, too. */
enum { DEM__CAPS = DEM_CLUMP_MAX, DEM__LATITUDES = 10 * DEM__CAPS };

/* Lists what others cover of ball i. Returns how many do. */
static inline int dem__find_caps(int n, const dem_vec *centre, const double *radius, int i, dem__cover *cap) {
    int m = 0;
    for (int j = 0; j < n; j++) {
        const dem_vec d = dem__sub(centre[j], centre[i]);
        const double square = dem__dot(d, d), sum = radius[i] + radius[j], r = radius[i];
        if (j == i || !(square < sum * sum) || sqrt(square) + radius[j] <= r) continue;
        cap[m].d = d, cap[m].h = 0.5 * (square + (r - radius[j]) * (r + radius[j])) / r;
        cap[m].across = sqrt(d.x * d.x + d.y * d.y), cap[m].angle = riddle_atan2(d.y, d.x);
        m++;
    }
    return m;
}

/* Returns whether a cap other than a and b covers a direction, by more than rounding. */
static inline int dem__is_covered(int m, const dem__cover *cap, dem_vec n, int a, int b) {
    for (int k = 0; k < m; k++) {
        if (k != a && k != b && dem__dot(n, cap[k].d) > cap[k].h + 1e-11 * dem__length(cap[k].d)) return 1;
    }
    return 0;
}

/* Adds a latitude to a list in ascending order. Returns the new length. */
static inline int dem__insert_latitude(double *t, int count, double z) {
    int k = count;
    while (t[k - 1] > z) k--;
    if (count == DEM__LATITUDES || z - t[k - 1] < 1e-15 || (k < count && t[k] - z < 1e-15)) return count;
    memmove(t + k + 1, t + k, (size_t)(count - k) * sizeof *t);
    t[k] = z;
    return count + 1;
}

/* Lists the latitudes, from -1 to 1, at which the exposed arcs change their number: where the rim of a cap is highest
   or lowest, and where two rims meet. */
static inline int dem__find_latitudes(int m, const dem__cover *cap, double *t) {
    int count = 2;
    t[0] = -1.0, t[1] = 1.0;
    for (int a = 0; a < m; a++) {
        const dem_vec d = cap[a].d;
        const double square = dem__dot(d, d), left = square - cap[a].h * cap[a].h;
        for (double side = -1.0; side < 2.0 && left > 0.0; side += 2.0) {
            const double z = (cap[a].h * d.z + side * cap[a].across * sqrt(left)) / square;
            dem_vec n = dem__scale(cap[a].h / square, d);
            if (cap[a].across > 0.0) { /* up or down along the rim's plane */
                const double up = side * sqrt(left) / (square * cap[a].across);
                n = dem__plus(n, up, dem_vec3(-d.z * d.x, -d.z * d.y, cap[a].across * cap[a].across));
            }
            if (z > -1.0 && z < 1.0 && !(cap[a].across > 0.0 && dem__is_covered(m, cap, n, a, a)))
                count = dem__insert_latitude(t, count, z);
        }
        for (int b = 0; b < a; b++) {
            const dem_vec axis = dem__cross(d, cap[b].d);
            const double bb = dem__dot(cap[b].d, cap[b].d), ab = dem__dot(d, cap[b].d), det = dem__dot(axis, axis);
            if (!(det > 1e-24 * square * bb)) continue;
            const dem_vec foot = dem__plus(dem__scale((cap[a].h * bb - cap[b].h * ab) / det, d),
                                           (cap[b].h * square - cap[a].h * ab) / det, cap[b].d);
            const double rest = 1.0 - dem__dot(foot, foot);
            for (double side = -1.0; side < 2.0 && rest > 0.0; side += 2.0) {
                const dem_vec n = dem__plus(foot, side * sqrt(rest / det), axis);
                if (n.z > -1.0 && n.z < 1.0 && !dem__is_covered(m, cap, n, a, b))
                    count = dem__insert_latitude(t, count, n.z);
            }
        }
    }
    return count;
}

/* Adds the arc of a latitude t between two angles. */
static inline void dem__add_arc(dem__exposed *e, double weight, double t, double from, double to) {
    const double across = sqrt((1.0 - t) * (1.0 + t));
    double in[4][4], side = -1.0; /* of cos^a sin^b */
    memset(in, 0, sizeof in);
    for (int k = 0; k < 2; k++, side = 1.0) {
        const double angle = k ? to : from, c = riddle_cos(angle), s = riddle_sin(angle);
        in[0][0] += side * angle, in[1][0] += side * s, in[0][1] -= side * c;
        in[2][0] += side * 0.5 * (angle + s * c), in[0][2] += side * 0.5 * (angle - s * c);
        in[1][1] += side * 0.5 * s * s, in[3][0] += side * (s - s * s * s / 3.0);
        in[2][1] -= side * c * c * c / 3.0, in[1][2] += side * s * s * s / 3.0;
        in[0][3] += side * (c * c * c / 3.0 - c);
    }
    for (int a = 0; a < 4; a++) {
        for (int b = 0; a + b < 4; b++) {
            in[a][b] *= weight;
            for (int k = 0; k < a + b; k++) in[a][b] *= across;
        }
    }
    e->zero += in[0][0];
    for (int p = 0; p < 3; p++) {
        e->one[p] += in[p == 0][p == 1] * (p == 2 ? t : 1.0);
        for (int q = 0; q < 3; q++) {
            const double z = (p == 2 ? t : 1.0) * (q == 2 ? t : 1.0);
            e->two[p][q] += in[(p == 0) + (q == 0)][(p == 1) + (q == 1)] * z;
            for (int s = 0; s < 3; s++)
                e->three[p][q][s] +=
                    in[(p == 0) + (q == 0) + (s == 0)][(p == 1) + (q == 1) + (s == 1)] * z * (s == 2 ? t : 1.0);
        }
    }
}

/* Adds the exposed arcs of a latitude. */
static inline void dem__add_latitude(dem__exposed *e, double weight, double t, int m, const dem__cover *cap) {
    double begin[2 * DEM__CAPS], end[2 * DEM__CAPS], from = -RIDDLE_PI;
    const double across = sqrt((1.0 - t) * (1.0 + t));
    int arcs = 0;
    for (int k = 0; k < m; k++) {
        const double most = across * cap[k].across, least = cap[k].h - t * cap[k].d.z;
        if (least >= most) continue;
        if (least <= -most) return; /* all is covered */
        const double half = riddle_acos(least / most);
        double a = cap[k].angle - half, b = cap[k].angle + half;
        if (a < -RIDDLE_PI) begin[arcs] = a + 2.0 * RIDDLE_PI, end[arcs++] = RIDDLE_PI, a = -RIDDLE_PI;
        if (b > RIDDLE_PI) begin[arcs] = -RIDDLE_PI, end[arcs++] = b - 2.0 * RIDDLE_PI, b = RIDDLE_PI;
        begin[arcs] = a, end[arcs++] = b;
    }
    for (int k = 1; k < arcs; k++) {
        const double a = begin[k], b = end[k];
        int q = k;
        for (; q > 0 && begin[q - 1] > a; q--) begin[q] = begin[q - 1], end[q] = end[q - 1];
        begin[q] = a, end[q] = b;
    }
    for (int k = 0; k <= arcs; k++) {
        const double to = k < arcs ? begin[k] : RIDDLE_PI;
        if (to > from) dem__add_arc(e, weight, t, from, to);
        if (k < arcs && end[k] > from) from = end[k];
    }
}

/* A range of the latitudes t = middle + half sin(pi/2 s) between two of them, from one s to another. */
typedef struct dem__zone {
    double middle, half, from, to;
} dem__zone;

/* Integrates over a zone by Gauss's rule with 16 points. */
static inline void dem__add_zone(dem__exposed *e, const dem__zone *z, int m, const dem__cover *cap) {
    static const double node[8] = {0.095012509837637441, 0.28160355077925892, 0.45801677765722737, 0.61787624440264377,
                                   0.755404408355003,    0.86563120238783176, 0.9445750230732326,  0.98940093499164994};
    static const double part[8] = {0.18945061045506847,  0.18260341504492361, 0.16915651939500256,
                                   0.14959598881657682,  0.12462897125553395, 0.095158511682492897,
                                   0.062253523938647776, 0.027152459411754058};
    const double half = 0.25 * RIDDLE_PI * (z->to - z->from), middle = 0.25 * RIDDLE_PI * (z->to + z->from);
    for (int g = 0; g < 16; g++) {
        const double s = middle + half * (g < 8 ? -node[7 - g] : node[g - 8]);
        const double weight = half * z->half * riddle_cos(s) * part[g < 8 ? 7 - g : g - 8];
        dem__add_latitude(e, weight, z->middle + z->half * riddle_sin(s), m, cap);
    }
}

static inline void dem__add_exposed(dem__exposed *e, const dem__exposed *of) {
    e->zero += of->zero;
    for (int p = 0; p < 3; p++) {
        e->one[p] += of->one[p];
        for (int q = 0; q < 3; q++) {
            e->two[p][q] += of->two[p][q];
            for (int s = 0; s < 3; s++) e->three[p][q][s] += of->three[p][q][s];
        }
    }
}

/* Integrates over a zone. Halves it if that changes its integrals, because a rim then ends just beyond it. */
enum { DEM__HALVINGS = 12 };
static inline void dem__expose_zone(dem__exposed *e, dem__zone z, int m, const dem__cover *cap) {
    dem__zone left[DEM__HALVINGS + 1]; /* zones left, each half as wide as the one before */
    int n = 0;
    left[n++] = z;
    while (n > 0) {
        dem__exposed whole, halves;
        dem__zone low = left[--n], high = low;
        memset(&whole, 0, sizeof whole), memset(&halves, 0, sizeof halves);
        low.to = high.from = 0.5 * (high.from + high.to);
        dem__add_zone(&whole, &left[n], m, cap);
        dem__add_zone(&halves, &low, m, cap), dem__add_zone(&halves, &high, m, cap);
        const double change = fabs(halves.zero - whole.zero) + fabs(halves.one[0] - whole.one[0]) +
                              fabs(halves.one[1] - whole.one[1]) + fabs(halves.two[2][2] - whole.two[2][2]);
        if (change > 1e-13 && n + 2 <= DEM__HALVINGS) left[n++] = high, left[n++] = low;
        else dem__add_exposed(e, &halves);
    }
}

/* Integrates over the exposed part of a ball. */
static inline void dem__expose(int m, const dem__cover *cap, dem__exposed *e) {
    double t[DEM__LATITUDES];
    const int count = dem__find_latitudes(m, cap, t);
    memset(e, 0, sizeof *e);
    for (int k = 1; k < count; k++) {
        const dem__zone z = {0.5 * (t[k] + t[k - 1]), 0.5 * (t[k] - t[k - 1]), -1.0, 1.0};
        if (z.half > 1e-16) dem__expose_zone(e, z, m, cap);
    }
}

/* Adds the content that the exposed surface of a ball at c encloses with the origin. */
static inline void dem__add_enclosed(dem__content *to, const dem__exposed *e, dem_vec c, double r) {
    const double centre[3] = {c.x, c.y, c.z};
    double zero = r * e->zero, one[3], first[3], second[3][3]; /* of (x n) times 1, n, n n; then of x, x x */
    for (int p = 0; p < 3; p++) zero += centre[p] * e->one[p];
    for (int p = 0; p < 3; p++) {
        one[p] = r * e->one[p];
        for (int s = 0; s < 3; s++) one[p] += centre[s] * e->two[p][s];
        first[p] = centre[p] * zero + r * one[p];
    }
    for (int p = 0; p < 3; p++) {
        for (int q = 0; q < 3; q++) {
            double two = r * e->two[p][q];
            for (int s = 0; s < 3; s++) two += centre[s] * e->three[p][q][s];
            second[p][q] = centre[p] * centre[q] * zero + r * (centre[p] * one[q] + centre[q] * one[p] + r * two);
        }
    }
    const double area = r * r;
    to->volume += area / 3.0 * zero;
    to->first = dem__plus(to->first, 0.25 * area, dem_vec3(first[0], first[1], first[2]));
    for (int p = 0; p < 3; p++)
        to->second[p] += 0.2 * area * second[p][p], to->second[3 + p] += 0.2 * area * second[p][(p + 1) % 3];
}

/* Adds a content that was computed about another origin. */
static inline void dem__add_shifted(dem__content *to, const dem__content *of, dem_vec origin) {
    const double o[3] = {origin.x, origin.y, origin.z}, f[3] = {of->first.x, of->first.y, of->first.z};
    to->volume += of->volume;
    to->first = dem__add(to->first, dem__plus(of->first, of->volume, origin));
    for (int p = 0; p < 3; p++) {
        const int q = (p + 1) % 3;
        to->second[p] += of->second[p] + 2.0 * o[p] * f[p] + of->volume * o[p] * o[p];
        to->second[3 + p] += of->second[3 + p] + o[p] * f[q] + o[q] * f[p] + of->volume * o[p] * o[q];
    }
}

/* Adds the union of balls. Connected balls are integrated about one of them, so that no digits are lost however far
   apart others are. */
static inline void dem__add_union(dem__content *c, int n, const dem_vec *centre, const double *radius) {
    int of[DEM_CLUMP_MAX]; /* the first of the balls connected with it */
    dem__cover cap[DEM__CAPS];
    dem__exposed e;
    dem__content own;
    for (int k = 0; k < n; k++) of[k] = k;
    for (int a = 0; a < n; a++) {
        for (int b = 0; b < a; b++) {
            const dem_vec d = dem__sub(centre[a], centre[b]);
            const double sum = radius[a] + radius[b];
            const int low = of[a] < of[b] ? of[a] : of[b], high = of[a] < of[b] ? of[b] : of[a];
            if (!(dem__dot(d, d) < sum * sum)) continue;
            for (int k = 0; k < n; k++) of[k] = of[k] == high ? low : of[k];
        }
    }
    for (int first = 0; first < n; first++) {
        memset(&own, 0, sizeof own);
        for (int k = first; k < n; k++) {
            if (of[k] != first) continue;
            dem__expose(dem__find_caps(n, centre, radius, k, cap), cap, &e);
            dem__add_enclosed(&own, &e, dem__sub(centre[k], centre[first]), radius[k]);
        }
        dem__add_shifted(c, &own, centre[first]);
    }
}
