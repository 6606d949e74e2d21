/* The convex hull of any number of points, in triangles (Barber, Dobkin & Huhdanpaa 1996, farthest points first). Reads
   points; allocates a builder. Promises: sides are decided exactly for coordinates rounded to 2^-50 of the size, so
   that points in one plane or line, or given twice, still make a closed surface. */
#pragma once
#include "../base/definition.h"

#define DEM__HULL_MAX 65536 /* corners of a hull, at most */

/* A triangle of a hull, counterclockwise from outside. */
typedef struct dem__hull_face {
    int32_t corner[3], beside[3]; /* beside[k]: the triangle across the edge from corner k to the next one */
    int32_t first, farthest;      /* first of the list of points in front of it, or -1; the farthest of them */
    int32_t next, queued; /* next of the triangles with such points, or of the unused ones; whether it is queued among
                             the former */
    int32_t alive, seen;  /* seen: index of the last point that saw it */
    dem_vec normal;       /* unit vector */
    double height;        /* of the farthest point, in units of the builder */
} dem__hull_face;

/* Work space of a hull. */
typedef struct dem__hull_builder {
    dem_allocator allocator;
    ptrdiff_t n;
    double *x;             /* [n][3]: points relative to their middle, whole numbers up to 2^50 */
    double unit;           /* of x [m] */
    int32_t *next;         /* [n]: lists of points */
    int32_t *begins;       /* [n]: the new triangle whose rim begins at a corner */
    dem__hull_face *facet; /* [capacity] */
    int32_t *list, *rim;   /* [capacity], [capacity][3]: triangles that a point sees; the rim around them: from, to,
                              triangle */
    int32_t facets, capacity, unused, queue;
    int32_t corners; /* points added; not all of them are corners in the end */
    int farthest;    /* whether the farthest point of all comes next; then triangles need no queue */
    void *block;
    size_t bytes;
} dem__hull_builder;

/* Splits a b into the rounded product p and the rest e (Dekker 1971). */
DEM_INLINE void dem__two_product(double a, double b, double *p, double *e) {
    const double factor = 134217729.0, u = factor * a, v = factor * b;
    const double high = u - (u - a), low = a - high, top = v - (v - b), rest = b - top;
    *p = a * b;
    *e = low * rest - (((*p - high * top) - low * top) - high * rest);
}

/* Adds a number to an exact sum of n components, from small to large (Shewchuk 1997, grow-expansion). */
static inline int dem__grow_sum(double *sum, int n, double term) {
    for (int k = 0; k < n; k++) {
        const double all = term + sum[k], part = all - term;
        sum[k] = (term - (all - part)) + (sum[k] - part);
        term = all;
    }
    sum[n] = term;
    return n + 1;
}

/* Returns the sign of the determinant of three vectors of whole numbers, exactly. */
static DEM__NOINLINE int dem__exact_sign(const double *u, const double *v, const double *w) {
    double sum[24];
    int n = 0;
    for (int k = 0; k < 6; k++) {
        const int a = k % 3, b = (k < 3 ? a + 1 : a + 2) % 3, c = 3 - a - b;
        double p, rest, parts[4];
        dem__two_product(k < 3 ? u[a] : -u[a], v[b], &p, &rest);
        dem__two_product(p, w[c], &parts[0], &parts[1]);
        dem__two_product(rest, w[c], &parts[2], &parts[3]);
        for (int q = 0; q < 4; q++) n = dem__grow_sum(sum, n, parts[q]);
    }
    while (n > 0 && sum[n - 1] == 0.0) n--;
    return n == 0 ? 0 : sum[n - 1] > 0.0 ? 1 : -1;
}

/* Returns 1 if point p is in front of the triangle a, b, c, -1 if behind, 0 if in its plane. */
static inline int dem__side_of(const double *a, const double *b, const double *c, const double *p) {
    double u[3], v[3], w[3], sum = 0.0, size = 0.0;
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k], w[k] = p[k] - a[k];
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        const double one = u[l] * v[m], two = u[m] * v[l];
        sum += w[k] * (one - two), size += fabs(w[k]) * (fabs(one) + fabs(two));
    }
    if (fabs(sum) > 1e-15 * size) return sum > 0.0 ? 1 : -1;
    return size > 0.0 ? dem__exact_sign(u, v, w) : 0;
}

DEM_INLINE int dem__sees(const dem__hull_builder *b, int32_t p, int32_t f) {
    const int32_t *c = b->facet[f].corner;
    return dem__side_of(b->x + 3 * c[0], b->x + 3 * c[1], b->x + 3 * c[2], b->x + 3 * p) > 0;
}
DEM_INLINE dem_vec dem__hull_point(const dem__hull_builder *b, int32_t k) {
    return dem_vec3(b->x[3 * k], b->x[3 * k + 1], b->x[3 * k + 2]);
}

/* Allocates a builder for n points. Returns 0 when out of memory. */
static inline int dem__begin_hull(dem__hull_builder *b, const dem_allocator *a, ptrdiff_t n) {
    const size_t points = (size_t)n, facets = 2 * (points < DEM__HULL_MAX ? points : DEM__HULL_MAX) + 8;
    memset(b, 0, sizeof *b);
    b->allocator = *a, b->n = n, b->capacity = (int32_t)facets;
    b->bytes = facets * (sizeof *b->facet + 4 * sizeof(int32_t)) + points * (3 * sizeof(double) + 2 * sizeof(int32_t));
    b->block = a->fn(a->user, NULL, 0, b->bytes);
    if (!b->block) return 0;
    b->facet = (dem__hull_face *)b->block;
    b->x = (double *)(void *)(b->facet + facets);
    b->next = (int32_t *)(void *)(b->x + 3 * points), b->begins = b->next + points;
    b->list = b->begins + points, b->rim = b->list + facets;
    return 1;
}
static inline void dem__end_hull(dem__hull_builder *b) {
    if (b->block) b->allocator.fn(b->allocator.user, b->block, b->bytes, 0);
    b->block = NULL;
}

/* Sets the points x [n][3], relative to the middle of their bounding box, rounded. */
static inline void dem__set_points(dem__hull_builder *b, const double *x) {
    double low[3], high[3], size = 0.0;
    int exponent = 0;
    for (int a = 0; a < 3; a++) {
        low[a] = high[a] = x[a];
        for (ptrdiff_t k = 1; k < b->n; k++)
            low[a] = x[3 * k + a] < low[a] ? x[3 * k + a] : low[a],
            high[a] = x[3 * k + a] > high[a] ? x[3 * k + a] : high[a];
        size = high[a] - low[a] > size ? high[a] - low[a] : size;
    }
    (void)frexp(size, &exponent);
    b->unit = ldexp(1.0, exponent - 50);
    for (ptrdiff_t k = 0; k < 3 * b->n; k++) {
        const int a = (int)(k % 3);
        b->x[k] = floor((x[k] - 0.5 * (low[a] + high[a])) / b->unit + 0.5);
    }
}

/* Returns the index of an unused triangle, which gets these corners; -1 if there is none. */
static inline int32_t dem__new_facet(dem__hull_builder *b, int32_t i, int32_t j, int32_t k) {
    int32_t f = b->unused;
    if (f >= 0) b->unused = b->facet[f].next;
    else if (b->facets == b->capacity) return -1;
    else f = b->facets++, b->facet[f].queued = 0;
    dem__hull_face *facet = &b->facet[f];
    const dem_vec a = dem__hull_point(b, i),
                  n = dem__cross(dem__sub(dem__hull_point(b, j), a), dem__sub(dem__hull_point(b, k), a));
    const double size = dem__length(n);
    facet->corner[0] = i, facet->corner[1] = j, facet->corner[2] = k;
    facet->first = facet->farthest = facet->seen = -1, facet->alive = 1, facet->height = 0.0;
    facet->normal = size > 0.0 ? dem__scale(1.0 / size, n) : dem_vec3(0.0, 0.0, 0.0);
    return f;
}

/* Assigns point p to triangle f if it is in front of it. Returns whether it is. */
static inline int dem__give_point(dem__hull_builder *b, int32_t p, int32_t f) {
    dem__hull_face *facet = &b->facet[f];
    if (!dem__sees(b, p, f)) return 0;
    const double height =
        dem__dot(facet->normal, dem__sub(dem__hull_point(b, p), dem__hull_point(b, facet->corner[0])));
    b->next[p] = facet->first, facet->first = p;
    if (facet->farthest < 0 || height > facet->height) facet->height = height, facet->farthest = p;
    return 1;
}

/* Finds four points that are far apart. Returns 0 if all points lie in one plane, up to `flat` [m]. */
static inline int dem__first_four(const dem__hull_builder *b, double flat, int32_t *four) {
    const int32_t n = (int32_t)b->n;
    double most[3] = {0.0, 0.0, 0.0};
    four[0] = four[1] = four[2] = four[3] = 0;
    for (int32_t k = 1; k < n; k++) {
        const double *p = b->x + 3 * k, *q = b->x + 3 * four[0];
        if (p[0] < q[0] || (p[0] == q[0] && (p[1] < q[1] || (p[1] == q[1] && p[2] < q[2])))) four[0] = k;
    }
    const dem_vec a = dem__hull_point(b, four[0]);
    for (int32_t k = 0; k < n; k++) {
        const double far = dem__length(dem__sub(dem__hull_point(b, k), a));
        if (far > most[0]) most[0] = far, four[1] = k;
    }
    const dem_vec u = dem__sub(dem__hull_point(b, four[1]), a);
    for (int32_t k = 0; k < n; k++) {
        const double far = dem__length(dem__cross(u, dem__sub(dem__hull_point(b, k), a)));
        if (far > most[1]) most[1] = far, four[2] = k;
    }
    const dem_vec up = dem__cross(u, dem__sub(dem__hull_point(b, four[2]), a));
    const double area = dem__length(up);
    for (int32_t k = 0; k < n; k++) {
        const double far = fabs(dem__dot(up, dem__sub(dem__hull_point(b, k), a)));
        if (far > most[2]) most[2] = far, four[3] = k;
    }
    return area > 0.0 && most[2] > flat / b->unit * area && most[1] > flat / b->unit * most[0];
}

/* Queues a triangle that has points in front of it. */
DEM_INLINE void dem__queue_facet(dem__hull_builder *b, int32_t f) {
    dem__hull_face *facet = &b->facet[f];
    if (b->farthest || facet->first < 0 || facet->queued) return;
    facet->queued = 1, facet->next = b->queue, b->queue = f;
}

/* Makes the first four triangles, and assigns the points to them. Returns 0 if all points lie in one plane. */
static inline int dem__first_facets(dem__hull_builder *b, double flat) {
    int32_t four[4];
    if (!dem__first_four(b, flat, four)) return 0;
    if (dem__side_of(b->x + 3 * four[0], b->x + 3 * four[1], b->x + 3 * four[2], b->x + 3 * four[3]) > 0) {
        const int32_t swap = four[1];
        four[1] = four[2], four[2] = swap;
    }
    static const int32_t corner[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}},
                         beside[4][3] = {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}};
    for (int f = 0; f < 4; f++) {
        dem__new_facet(b, four[corner[f][0]], four[corner[f][1]], four[corner[f][2]]);
        for (int k = 0; k < 3; k++) b->facet[f].beside[k] = beside[f][k];
    }
    for (int32_t p = 0; p < (int32_t)b->n; p++) {
        if (p == four[0] || p == four[1] || p == four[2] || p == four[3]) continue;
        for (int32_t f = 0; f < 4 && !dem__give_point(b, p, f);) f++;
    }
    for (int32_t f = 0; f < 4; f++) dem__queue_facet(b, f);
    b->corners = 4;
    return 1;
}

/* Finds the triangles that point p sees, starting at f, and the rim around them. Returns the length of the rim. */
static inline int32_t dem__find_seen(dem__hull_builder *b, int32_t p, int32_t f, int32_t *seen) {
    int32_t rim = 0;
    *seen = 1;
    b->list[0] = f, b->facet[f].seen = p;
    for (int32_t at = 0; at < *seen; at++) {
        const dem__hull_face *facet = &b->facet[b->list[at]];
        for (int k = 0; k < 3; k++) {
            const int32_t other = facet->beside[k];
            if (b->facet[other].seen == p) continue;
            if (dem__sees(b, p, other)) {
                b->facet[other].seen = p, b->list[(*seen)++] = other;
                continue;
            }
            b->rim[3 * rim] = facet->corner[k], b->rim[3 * rim + 1] = facet->corner[(k + 1) % 3];
            b->rim[3 * rim++ + 2] = other;
        }
    }
    return rim;
}

/* Adds point p, which triangle f sees, to the hull. Returns 0 if it does not fit. */
static inline int dem__add_hull_point(dem__hull_builder *b, int32_t p, int32_t f) {
    int32_t seen;
    const int32_t rim = dem__find_seen(b, p, f, &seen);
    int32_t points = -1;
    for (int32_t m = 0; m < seen; m++) { /* points of removed triangles */
        dem__hull_face *facet = &b->facet[b->list[m]];
        for (int32_t q = facet->first, next; q >= 0; q = next) {
            next = b->next[q];
            if (q != p) b->next[q] = points, points = q;
        }
        facet->first = -1, facet->alive = 0;
        if (facet->queued) continue; /* the queue returns it later */
        facet->next = b->unused, b->unused = b->list[m];
    }
    for (int32_t m = 0; m < rim; m++) {
        const int32_t from = b->rim[3 * m], to = b->rim[3 * m + 1], other = b->rim[3 * m + 2];
        const int32_t fresh = dem__new_facet(b, from, to, p);
        if (fresh < 0) return 0;
        b->facet[fresh].beside[0] = other;
        for (int k = 0; k < 3; k++) {
            if (b->facet[other].corner[k] == to && b->facet[other].corner[(k + 1) % 3] == from)
                b->facet[other].beside[k] = fresh;
        }
        b->begins[from] = fresh, b->list[m] = fresh;
    }
    for (int32_t m = 0; m < rim; m++) {
        const int32_t after = b->begins[b->facet[b->list[m]].corner[1]];
        b->facet[b->list[m]].beside[1] = after, b->facet[after].beside[2] = b->list[m];
    }
    for (int32_t q = points, next; q >= 0; q = next) {
        next = b->next[q];
        for (int32_t m = 0; m < rim && !dem__give_point(b, q, b->list[m]);) m++;
    }
    for (int32_t m = 0; m < rim; m++) dem__queue_facet(b, b->list[m]);
    b->corners++;
    return 1;
}

/* Takes a triangle that has points in front of it: the next one, or the one with the farthest point of all. Returns -1
   if there is none. */
static inline int32_t dem__next_facet(dem__hull_builder *b) {
    int32_t best = -1;
    while (!b->farthest && b->queue >= 0) {
        const int32_t f = b->queue;
        dem__hull_face *facet = &b->facet[f];
        b->queue = facet->next, facet->queued = 0;
        if (facet->alive && facet->first >= 0) return f;
        if (!facet->alive) facet->next = b->unused, b->unused = f;
    }
    for (int32_t f = 0; f < b->facets && b->farthest; f++) {
        const dem__hull_face *facet = &b->facet[f];
        if (facet->alive && facet->first >= 0 && (best < 0 || facet->height > b->facet[best].height)) best = f;
    }
    return best;
}

/* Finds the point that is highest above a triangle of the hull, and that triangle. Returns the height [units]. */
static inline double dem__highest_point(const dem__hull_builder *b, int32_t *point, int32_t *f) {
    double most = 0.0;
    for (int32_t g = 0; g < b->facets; g++) {
        const dem__hull_face *facet = &b->facet[g];
        const dem_vec a = dem__hull_point(b, facet->corner[0]);
        for (int32_t p = 0; p < (int32_t)b->n && facet->alive; p++) {
            const double height = dem__dot(facet->normal, dem__sub(dem__hull_point(b, p), a));
            if (height > most) most = height, *point = p, *f = g;
        }
    }
    return most;
}

/* Builds the hull of at most `most` of the points [n][3] [m], farthest ones first, until all others are closer to it
   than `tolerance` [m]. Returns 0 if the points lie in one plane, up to that. */
static inline int dem__build_few(dem__hull_builder *b, const double *x, int most, double tolerance) {
    int32_t point = 0, f = 0;
    b->facets = b->corners = 0, b->unused = b->queue = -1, b->farthest = 1;
    dem__set_points(b, x);
    if (!dem__first_facets(b, tolerance)) return 0;
    for (int32_t k = 0; k < b->facets; k++) b->facet[k].first = -1; /* these lists are not used */
    while (b->corners < most && dem__highest_point(b, &point, &f) * b->unit > tolerance) {
        if (!dem__add_hull_point(b, point, f)) return 0;
    }
    return 1;
}

enum { DEM__HULL_OK, DEM__HULL_FLAT, DEM__HULL_LARGE };
/* Builds the hull of points x [n][3] [m], finite and not all the same. It has at most `most` corners; points closer to
   it than `tolerance` [m] do not become corners. flat: thickness below which there is no hull [m]. */
static inline int dem__build_hull(dem__hull_builder *b, const double *x, int32_t most, double tolerance, double flat) {
    b->farthest = most < DEM__HULL_MAX || tolerance > 0.0;
    b->facets = b->corners = 0, b->unused = b->queue = -1;
    dem__set_points(b, x);
    if (!dem__first_facets(b, flat)) return DEM__HULL_FLAT;
    for (;;) {
        const int32_t f = dem__next_facet(b);
        if (f < 0 || (b->farthest && (b->corners >= most || b->facet[f].height * b->unit <= tolerance)))
            return DEM__HULL_OK;
        if (b->corners >= DEM__HULL_MAX || !dem__add_hull_point(b, b->facet[f].farthest, f)) return DEM__HULL_LARGE;
    }
}

/* Returns an upper limit of the distance between the hull and the points left out [m]. */
static inline double dem__left_out(const dem__hull_builder *b) {
    double most = 0.0;
    for (int32_t f = 0; f < b->facets; f++)
        if (b->facet[f].alive && b->facet[f].first >= 0 && b->facet[f].height > most) most = b->facet[f].height;
    return most * b->unit;
}
