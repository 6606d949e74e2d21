/* faces.h: populations that enter through non-periodic faces of the box: walls, given pressure, symmetry. Relies on lattice.h, collide.h
   (task_range).
   May be changed here alone: everything. */

/* ==== >>faces ==== */

#define FILTRATION__BLOCK 64

/* Finds the face by which a population leaves; a wall takes precedence over an open face, that over a mirror. crossed: the axes, as bits.
   Returns 3 for a wall, 2 for an open face, 1 for a mirror, 0 if it does not leave. */
static inline int filtration__crossing(const filtration__lattice *l, int x, int y, int z, int i, int *face, int *crossed) {
    const int at[3] = {x, y, z}, n[3] = {l->nx, l->ny, l->nz};
    int found = 0;
    *crossed = 0;
    for (int a = 0; a < 3; a++) {
        int to = at[a] + l->c[i][a], f = 2 * a + (to > 0);
        if ((to >= 0 && to < n[a]) || l->face[f] == FILTRATION_PERIODIC) continue;
        *crossed |= 1 << a;
        int rank = l->face[f] == FILTRATION_WALL ? 3 : l->face[f] == FILTRATION_PRESSURE ? 2 : 1;
        if (rank > found) found = rank, *face = f;
    }
    return found;
}

/* Returns the direction with the signs of some axes (as bits) reversed. */
static inline int filtration__turned(const filtration__lattice *l, int i, int axes) {
    for (int j = 0; j < l->q; j++) {
        int same = 1;
        for (int a = 0; a < 3; a++) same &= l->c[j][a] == ((axes >> a & 1) ? -l->c[i][a] : l->c[i][a]);
        if (same) return j;
    }
    return i;
}

/* Moves p, beyond the box by at most one node, into the box: wrapped, or mirrored with the axes as bits in *mirrored. Returns 0 beyond
   walls and open faces. */
static inline int filtration__inside(const filtration__lattice *l, int p[3], int *mirrored) {
    const int n[3] = {l->nx, l->ny, l->nz};
    *mirrored = 0;
    for (int a = 0; a < 3; a++) {
        if (p[a] >= 0 && p[a] < n[a]) continue;
        filtration_face kind = l->face[2 * a + (p[a] > 0)];
        if (kind == FILTRATION_PERIODIC) {
            p[a] %= n[a];
            if (p[a] < 0) p[a] += n[a];
        } else if (kind == FILTRATION_SYMMETRY && p[a] >= -1 && p[a] <= n[a]) {
            p[a] = p[a] < 0 ? -1 - p[a] : 2 * n[a] - 1 - p[a];
            *mirrored |= 1 << a;
        } else {
            return 0;
        }
    }
    return 1;
}

static inline void filtration__load(const filtration__lattice *l, ptrdiff_t place, int n, double *h) {
    if (l->single)
        for (int k = 0; k < n; k++) h[k] = (double)((const float *)l->f)[place + k];
    else memcpy(h, (const double *)l->f + place, (size_t)n * sizeof *h);
}

static inline void filtration__store(filtration__lattice *l, ptrdiff_t place, int n, const double *h) {
    if (l->single)
        for (int k = 0; k < n; k++) ((float *)l->f)[place + k] = (float)h[k];
    else memcpy((double *)l->f + place, h, (size_t)n * sizeof *h);
}

/* Computes the velocity of n nodes of a row after collision. */
static inline void filtration__row_velocity(const filtration__lattice *l, int x, int n, int y, int z, double u[3][FILTRATION__BLOCK]) {
    double h[FILTRATION__BLOCK];
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < n; k++) u[a][k] = -0.5 * l->rates.force[a];
    for (int i = 1; i < l->q; i++) {
        filtration__load(l, filtration__outgoing(l, x, y, z, i), n, h);
        for (int a = 0; a < 3; a++)
            for (int k = 0; l->c[i][a] && k < n; k++) u[a][k] += l->c[i][a] * h[k];
    }
}

/* Applies a given pressure by anti-bounce-back (Ginzburg et al. 2008). */
static inline void filtration__open(const filtration__lattice *l, int i, double r, int n, double u[3][FILTRATION__BLOCK], double *h) {
    for (int k = 0; k < n; k++) {
        double cu = l->c[i][0] * u[0][k] + l->c[i][1] * u[1][k] + l->c[i][2] * u[2][k];
        double uu = u[0][k] * u[0][k] + u[1][k] * u[1][k] + u[2][k] * u[2][k];
        h[k] = 2.0 * l->w[i] * (r + 4.5 * cu * cu - 1.5 * uu) - h[k];
    }
}

/* Processes n nodes of a row, at most FILTRATION__BLOCK, of one kind: all or none at an end of the row. */
static inline void filtration__face_block(filtration__lattice *l, int x, int n, int y, int z) {
    double u[3][FILTRATION__BLOCK] = {{0.0}}, h[FILTRATION__BLOCK];
    int have_velocity = 0;
    for (int i = 1; i < l->q; i++) {
        int face = 0, crossed, kind = filtration__crossing(l, x, y, z, i, &face, &crossed), back = filtration__opposite(i);
        if (!kind) continue;
        if (kind == 1) { /* a mirror: the incoming population is the one that left the mirrored neighbour */
            int m[3] = {x, y, z}, none;
            for (int a = 0; a < 3; a++)
                if (!(crossed >> a & 1)) m[a] += l->c[i][a];
            filtration__inside(l, m, &none);
            filtration__load(l, filtration__outgoing(l, m[0], m[1], m[2], filtration__turned(l, i, 7 & ~crossed)), n, h);
        } else {
            filtration__load(l, filtration__outgoing(l, x, y, z, i), n, h);
        }
        if (kind == 2) {
            if (!have_velocity) filtration__row_velocity(l, x, n, y, z, u);
            have_velocity = 1;
            filtration__open(l, i, l->face_density[face], n, u, h);
        }
        if (kind == 3) {
            const double *v = l->face_velocity[face];
            double push = 6.0 * l->w[i] * (l->c[i][0] * v[0] + l->c[i][1] * v[1] + l->c[i][2] * v[2]);
            for (int k = 0; k < n; k++) h[k] -= push;
        }
        filtration__store(l, filtration__incoming(l, x, y, z, back), n, h);
    }
}

static inline void filtration__face_row(filtration__lattice *l, int y, int z) {
    int at_face = (l->ghost_y && (y == 0 || y == l->ny - 1)) || (l->ghost_z && (z == 0 || z == l->nz - 1));
    if (!at_face && l->periodic_x) return;
    filtration__face_block(l, 0, 1, y, z);
    for (int x = 1; at_face && x < l->nx - 1; x += FILTRATION__BLOCK)
        filtration__face_block(l, x, l->nx - 1 - x < FILTRATION__BLOCK ? l->nx - 1 - x : FILTRATION__BLOCK, y, z);
    if (l->nx > 1) filtration__face_block(l, l->nx - 1, 1, y, z);
}

static void filtration__face_task(void *context, int task) {
    filtration__lattice *l = (filtration__lattice *)context;
    ptrdiff_t first, end;
    filtration__task_range((ptrdiff_t)l->ny * l->nz, task, &first, &end);
    for (ptrdiff_t k = first; k < end; k++) {
        int y = (int)(k % l->ny), z = (int)(k / l->ny);
        if (l->slab_active[z] && !(l->row_state[k] & FILTRATION__ROW_SOLID)) filtration__face_row(l, y, z);
    }
}
