/* mesh_solid.h: a closed surface of triangles as a solid of filtration.h, in a box that repeats. Include dem.h
   (dem_mesh) and filtration.h first. */
#ifndef RIDDLE_MESH_SOLID_H
#define RIDDLE_MESH_SOLID_H

typedef struct mesh_solid {
    const dem_mesh *mesh;
    double low[3], high[3]; /* corners of the surface [m] */
    double box[3];          /* from 0 [m] */
    int repeats[3];
    double small; /* a length below the voxel [m] */
    int cells;    /* of each plane's grid, along an edge */
    int *start[3], *list[3];
} mesh_solid;

static inline void mesh_solid_free(mesh_solid *m) {
    for (int a = 0; a < 3; a++) free(m->start[a]), free(m->list[a]), m->start[a] = m->list[a] = NULL;
}

static inline int mesh_cell(const mesh_solid *m, int axis, double x) {
    const double share = (x - m->low[axis]) / (m->high[axis] - m->low[axis]) * m->cells;
    return share <= 0.0 ? 0 : share >= m->cells ? m->cells - 1 : (int)share;
}

/* Files triangles under the cells of the plane perpendicular to an axis that they cover: counts, or stores. */
static inline void mesh_file(mesh_solid *m, int axis, int store) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    for (ptrdiff_t t = 0; t < m->mesh->triangles; t++) {
        double low[3], high[3];
        for (int k = 0; k < 3; k++) {
            low[k] = HUGE_VAL, high[k] = -HUGE_VAL;
            for (int v = 0; v < 3; v++) {
                const double x = m->mesh->vertex[3 * m->mesh->triangle[3 * t + v] + k];
                low[k] = fmin(low[k], x), high[k] = fmax(high[k], x);
            }
        }
        for (int j = mesh_cell(m, c, low[c] - m->small); j <= mesh_cell(m, c, high[c] + m->small); j++)
            for (int i = mesh_cell(m, b, low[b] - m->small); i <= mesh_cell(m, b, high[b] + m->small); i++) {
                int *at = &m->start[axis][j * m->cells + i];
                if (store) m->list[axis][(*at)++] = (int)t;
                else at[1]++;
            }
    }
}

/* 0, or -1: out of memory. */
static inline int mesh_solid_make(mesh_solid *m, const dem_mesh *mesh, const double box[3], const int repeats[3],
                                  double small) {
    memset(m, 0, sizeof *m);
    m->mesh = mesh, m->small = small;
    for (int k = 0; k < 3; k++) {
        m->box[k] = box[k], m->repeats[k] = repeats[k], m->low[k] = HUGE_VAL, m->high[k] = -HUGE_VAL;
        for (ptrdiff_t v = 0; v < mesh->vertices; v++)
            m->low[k] = fmin(m->low[k], mesh->vertex[3 * v + k]),
            m->high[k] = fmax(m->high[k], mesh->vertex[3 * v + k]);
        m->low[k] -= small, m->high[k] += small;
    }
    const double edge = sqrt((double)mesh->triangles);
    m->cells = edge < 1.0 ? 1 : edge < 400.0 ? (int)edge : 400;
    const size_t cells = (size_t)m->cells * (size_t)m->cells;
    for (int a = 0; a < 3; a++) {
        m->start[a] = calloc(cells + 2, sizeof(int));
        if (!m->start[a]) return -1;
        mesh_file(m, a, 0);
        for (size_t k = 0; k < cells; k++) m->start[a][k + 1] += m->start[a][k];
        m->list[a] = malloc(((size_t)m->start[a][cells] + 1) * sizeof(int));
        if (!m->list[a]) return -1;
        mesh_file(m, a, 1);
        memmove(m->start[a] + 1, m->start[a], cells * sizeof(int)); /* storing has moved each start to the next one */
        m->start[a][0] = 0;
    }
    return 0;
}

static inline const double *mesh_corner(const mesh_solid *m, int t, int v) {
    return &m->mesh->vertex[3 * m->mesh->triangle[3 * t + v]];
}

/* Is a point inside? An odd number of triangles lies beyond it along an axis; two of three axes decide. */
static inline int mesh_holds(const mesh_solid *m, const double p[3]) {
    int votes = 0;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        const double y = p[b] + 3.7e-7 * m->small, z = p[c] + 2.3e-7 * m->small; /* not through an edge of the mesh */
        const int cell = mesh_cell(m, c, z) * m->cells + mesh_cell(m, b, y);
        int crossings = 0;
        for (int k = m->start[a][cell]; k < m->start[a][cell + 1]; k++) {
            const int t = m->list[a][k];
            const double *u = mesh_corner(m, t, 0), *v = mesh_corner(m, t, 1), *w = mesh_corner(m, t, 2);
            const double e0 = (v[b] - u[b]) * (z - u[c]) - (v[c] - u[c]) * (y - u[b]);
            const double e1 = (w[b] - v[b]) * (z - v[c]) - (w[c] - v[c]) * (y - v[b]);
            const double e2 = (u[b] - w[b]) * (z - w[c]) - (u[c] - w[c]) * (y - w[b]);
            if (!((e0 > 0.0 && e1 > 0.0 && e2 > 0.0) || (e0 < 0.0 && e1 < 0.0 && e2 < 0.0))) continue;
            crossings += (e1 * u[a] + e2 * v[a] + e0 * w[a]) / (e0 + e1 + e2) > p[a];
        }
        votes += crossings & 1;
    }
    return votes >= 2;
}

/* Moves a point by whole boxes; returns 0 if the surface cannot reach it there. reach: the length of what
   begins at it [m]. */
static inline int mesh_moved(const mesh_solid *m, const double p[3], int image, double reach, double moved[3]) {
    for (int k = 0; k < 3; k++) {
        const int shift = image % 3 - 1;
        image /= 3;
        if (shift != 0 && !m->repeats[k]) return 0;
        moved[k] = p[k] + shift * m->box[k];
        if (moved[k] < m->low[k] - reach || moved[k] > m->high[k] + reach) return 0;
    }
    return 1;
}

static inline double mesh_distance(const void *self, const double p[3]) {
    const mesh_solid *m = self;
    double moved[3];
    for (int image = 0; image < 27; image++)
        if (mesh_moved(m, p, image, 0.0, moved) && mesh_holds(m, moved)) return -m->small;
    return m->small;
}

/* The share of the way from p to q at which it meets a triangle; 2: it does not (Moeller and Trumbore 1997). */
static inline double mesh_meets(const mesh_solid *m, int t, const double p[3], const double way[3]) {
    const double *u = mesh_corner(m, t, 0), *v = mesh_corner(m, t, 1), *w = mesh_corner(m, t, 2);
    double e1[3], e2[3], s[3], h[3], q[3];
    for (int k = 0; k < 3; k++) e1[k] = v[k] - u[k], e2[k] = w[k] - u[k], s[k] = p[k] - u[k];
    for (int k = 0; k < 3; k++) {
        const int b = (k + 1) % 3, c = (k + 2) % 3;
        h[k] = way[b] * e2[c] - way[c] * e2[b], q[k] = s[b] * e1[c] - s[c] * e1[b];
    }
    const double det = e1[0] * h[0] + e1[1] * h[1] + e1[2] * h[2];
    if (det == 0.0) return 2.0;
    const double a = (s[0] * h[0] + s[1] * h[1] + s[2] * h[2]) / det,
                 b = (way[0] * q[0] + way[1] * q[1] + way[2] * q[2]) / det;
    const double at = (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / det;
    return a >= -1e-9 && b >= -1e-9 && a + b <= 1.0 + 2e-9 && at >= 0.0 && at <= 1.0 ? at : 2.0;
}

static inline double mesh_cut(const void *self, const double fluid[3], const double solid[3]) {
    const mesh_solid *m = self;
    double way[3], moved[3], nearest = 2.0, reach = 0.0;
    for (int k = 0; k < 3; k++) way[k] = solid[k] - fluid[k], reach = fmax(reach, fabs(way[k]));
    for (int image = 0; image < 27; image++) {
        if (!mesh_moved(m, fluid, image, reach, moved)) continue;
        const int y0 = mesh_cell(m, 1, fmin(moved[1], moved[1] + way[1])),
                  y1 = mesh_cell(m, 1, fmax(moved[1], moved[1] + way[1]));
        const int z0 = mesh_cell(m, 2, fmin(moved[2], moved[2] + way[2])),
                  z1 = mesh_cell(m, 2, fmax(moved[2], moved[2] + way[2]));
        for (int z = z0; z <= z1; z++)
            for (int y = y0; y <= y1; y++)
                for (int k = m->start[0][z * m->cells + y]; k < m->start[0][z * m->cells + y + 1]; k++)
                    nearest = fmin(nearest, mesh_meets(m, m->list[0][k], moved, way));
    }
    return nearest > 1.0 ? 0.5 : fmax(nearest, 1e-6);
}

static inline filtration_solid mesh_as_solid(const mesh_solid *m) {
    filtration_solid solid;
    memset(&solid, 0, sizeof solid);
    solid.distance = mesh_distance, solid.cut = mesh_cut, solid.self = m;
    return solid;
}

#endif
