/* Collision of the nodes of a row; read once for doubles and once for floats. */

/* Reads population i of node x at p[i][x] and writes it back after collision at p[opposite of i][x]. Two relaxation
   times, and a third for the trace of the stress (Ginzburg et al. 2008; d'Humieres et al. 2002); forcing after Guo et
   al. (2002), split by parity. Returns whether a node is faster than the limit or not a number. A call processes `n`
   nodes from `first` on. The memory of the next row is prefetched into the second cache, because hardware prefetchers
   follow too few streams. */
#define FILTRATION__LOAD(i) const FILTRATION__REAL s##i = p##i[x] + p##i##o[x], d##i = p##i[x] - p##i##o[x];
#define FILTRATION__STORE(i, cu_, cf_, W)                                                                              \
    {                                                                                                                  \
        const FILTRATION__REAL cu = cu_;                                                                               \
        FILTRATION__REAL even = keep_plus * s##i + (W##_even + W##_square * (cu * cu)),                                \
                         odd = keep_minus * d##i + W##_odd * cu;                                                       \
        if (forced) {                                                                                                  \
            const FILTRATION__REAL cf = cf_;                                                                           \
            even += W##_force_even * (9 * cf * cu - uf3);                                                              \
            odd += W##_force_odd * cf;                                                                                 \
        }                                                                                                              \
        p##i##o[x] = even + odd;                                                                                       \
        p##i[x] = even - odd;                                                                                          \
    }
#define FILTRATION__POINTERS(i, j) FILTRATION__REAL *const p##i = p[i], *const p##i##o = p[j];

#define FILTRATION__CONSTANTS                                                                                          \
    const FILTRATION__REAL plus = (FILTRATION__REAL)rates->plus, minus = (FILTRATION__REAL)rates->minus;               \
    const FILTRATION__REAL keep_plus = (FILTRATION__REAL)0.5 * (1 - plus),                                             \
                           keep_minus = (FILTRATION__REAL)0.5 * (1 - minus);                                           \
    const FILTRATION__REAL trace = (FILTRATION__REAL)(rates->plus - rates->bulk),                                      \
                           limit = (FILTRATION__REAL)rates->limit;                                                     \
    const FILTRATION__REAL fx = (FILTRATION__REAL)rates->force[0], fy = (FILTRATION__REAL)rates->force[1],             \
                           fz = (FILTRATION__REAL)rates->force[2], half = (FILTRATION__REAL)0.5;                       \
    FILTRATION__FLAG bad = 0;

#define FILTRATION__WEIGHT(W, w)                                                                                       \
    const FILTRATION__REAL W##_plus = (FILTRATION__REAL)(w)*plus, W##_square = (FILTRATION__REAL)4.5 * W##_plus,       \
                           W##_odd = (FILTRATION__REAL)(3.0 * (w)) * minus,                                            \
                           W##_force_even = (FILTRATION__REAL)(w) * (1 - half * plus),                                 \
                           W##_force_odd = (FILTRATION__REAL)(3.0 * (w)) * (1 - half * minus);                         \
    (void)W##_force_even, (void)W##_force_odd;

/* Density, speed, trace of the non-equilibrium stress. c2: squared length of the outer directions; rest: weight at
   rest. */
#define FILTRATION__MOMENTS(c2, rest)                                                                                  \
    if (forced) ux += half * fx, uy += half * fy, uz += half * fz;                                                     \
    const FILTRATION__REAL h0 = p0[x], r = h0 + (axes + outer), uu = (ux * ux + uy * uy) + uz * uz;                    \
    const FILTRATION__REAL uf = forced ? (ux * fx + uy * fy) + uz * fz : 0, uf3 = 3 * uf,                              \
                           q = r - (FILTRATION__REAL)1.5 * uu;                                                         \
    const FILTRATION__REAL b = trace * ((axes + c2 * outer) - r - uu + uf);                                            \
    const FILTRATION__REAL rest_even = h0 - plus * (h0 - (FILTRATION__REAL)(rest)*q);                                  \
    p0[x] = rest_even - (FILTRATION__REAL)(1.5 * (rest)) * b -                                                         \
            (forced ? (FILTRATION__REAL)(rest) * (1 - half * plus) * uf3 : 0);                                         \
    bad |= uu < limit ? 0 : 1;

#define FILTRATION__SETUP                                                                                              \
    FILTRATION__REAL *const p0 = p[0];                                                                                 \
    FILTRATION__POINTERS(1, 2)                                                                                         \
    FILTRATION__POINTERS(3, 4)                                                                                         \
    FILTRATION__POINTERS(5, 6)                                                                                         \
    FILTRATION__POINTERS(7, 8)                                                                                         \
    FILTRATION__POINTERS(9, 10)                                                                                        \
    FILTRATION__POINTERS(11, 12)                                                                                       \
    FILTRATION__POINTERS(13, 14)                                                                                       \
    FILTRATION__CONSTANTS

FILTRATION__INLINE int FILTRATION__OF(filtration__nodes19)(FILTRATION__REAL *const *p, const filtration__rates *rates,
                                                           int first, int n, const int forced) {
    FILTRATION__SETUP
    FILTRATION__POINTERS(15, 16)
    FILTRATION__POINTERS(17, 18)
    FILTRATION__WEIGHT(axis, 1.0 / 18.0)
    FILTRATION__WEIGHT(edge, 1.0 / 36.0)
    FILTRATION__INDEPENDENT
    for (int x = first; x < first + n; x++) {
        FILTRATION__LOAD(1)
        FILTRATION__LOAD(3)
        FILTRATION__LOAD(5)
        FILTRATION__LOAD(7)
        FILTRATION__LOAD(9)
        FILTRATION__LOAD(11)
        FILTRATION__LOAD(13)
        FILTRATION__LOAD(15)
        FILTRATION__LOAD(17)
        const FILTRATION__REAL axes = s1 + s3 + s5, outer = ((s7 + s9) + (s11 + s13)) + (s15 + s17);
        FILTRATION__REAL ux = d1 + ((d7 + d9) + (d11 + d13)), uy = d3 + ((d7 - d9) + (d15 + d17)),
                         uz = d5 + ((d11 - d13) + (d15 - d17));
        FILTRATION__MOMENTS(2, 1.0 / 3.0)
        const FILTRATION__REAL axis_even = axis_plus * q,
                               edge_even = edge_plus * q + b * (FILTRATION__REAL)(1.0 / 24.0);
        FILTRATION__STORE(1, ux, fx, axis)
        FILTRATION__STORE(3, uy, fy, axis)
        FILTRATION__STORE(5, uz, fz, axis)
        FILTRATION__STORE(7, ux + uy, fx + fy, edge)
        FILTRATION__STORE(9, ux - uy, fx - fy, edge)
        FILTRATION__STORE(11, ux + uz, fx + fz, edge)
        FILTRATION__STORE(13, ux - uz, fx - fz, edge)
        FILTRATION__STORE(15, uy + uz, fy + fz, edge)
        FILTRATION__STORE(17, uy - uz, fy - fz, edge)
    }
    return bad != 0;
}

FILTRATION__INLINE int FILTRATION__OF(filtration__nodes15)(FILTRATION__REAL *const *p, const filtration__rates *rates,
                                                           int first, int n, const int forced) {
    FILTRATION__SETUP
    FILTRATION__WEIGHT(axis, 1.0 / 9.0)
    FILTRATION__WEIGHT(corner, 1.0 / 72.0)
    FILTRATION__INDEPENDENT
    for (int x = first; x < first + n; x++) {
        FILTRATION__LOAD(1)
        FILTRATION__LOAD(3)
        FILTRATION__LOAD(5)
        FILTRATION__LOAD(7)
        FILTRATION__LOAD(9)
        FILTRATION__LOAD(11)
        FILTRATION__LOAD(13)
        const FILTRATION__REAL axes = s1 + s3 + s5, outer = (s7 + s9) + (s11 + s13);
        FILTRATION__REAL ux = d1 + ((d7 + d9) + (d11 - d13)), uy = d3 + ((d7 + d9) - (d11 - d13)),
                         uz = d5 + ((d7 - d9) + (d11 + d13));
        FILTRATION__MOMENTS(3, 2.0 / 9.0)
        const FILTRATION__REAL axis_even = axis_plus * q,
                               corner_even = corner_plus * q + b * (FILTRATION__REAL)(1.0 / 24.0);
        FILTRATION__STORE(1, ux, fx, axis)
        FILTRATION__STORE(3, uy, fy, axis)
        FILTRATION__STORE(5, uz, fz, axis)
        FILTRATION__STORE(7, ux + uy + uz, fx + fy + fz, corner)
        FILTRATION__STORE(9, ux + uy - uz, fx + fy - fz, corner)
        FILTRATION__STORE(11, ux - uy + uz, fx - fy + fz, corner)
        FILTRATION__STORE(13, uy + uz - ux, fy + fz - fx, corner)
    }
    return bad != 0;
}

/* A row of n nodes: whole cache lines first, whose loops have a constant length. */
#define FILTRATION__ROW(nodes, directions)                                                                             \
    const int line = FILTRATION__LINE / (int)sizeof **p;                                                               \
    int bad = 0, x = 0;                                                                                                \
    for (; x + line <= n; x += line) {                                                                                 \
        for (int i = 0; i < directions; i++) FILTRATION__PREFETCH(p[i] + x + ahead);                                   \
        bad |= nodes(p, rates, x, line, forced);                                                                       \
    }                                                                                                                  \
    if (x < n) bad |= nodes(p, rates, x, n - x, forced);                                                               \
    return bad;
FILTRATION__INLINE int FILTRATION__OF(filtration__row19)(FILTRATION__REAL *const *p, const filtration__rates *rates,
                                                         int n, ptrdiff_t ahead, const int forced){
    FILTRATION__ROW(FILTRATION__OF(filtration__nodes19), 19)} FILTRATION__INLINE
    int FILTRATION__OF(filtration__row15)(FILTRATION__REAL *const *p, const filtration__rates *rates, int n,
                                          ptrdiff_t ahead, const int forced) {
    FILTRATION__ROW(FILTRATION__OF(filtration__nodes15), 15)
}
#undef FILTRATION__LOAD
#undef FILTRATION__STORE
#undef FILTRATION__POINTERS
#undef FILTRATION__CONSTANTS
#undef FILTRATION__WEIGHT
#undef FILTRATION__MOMENTS
#undef FILTRATION__SETUP
#undef FILTRATION__ROW
