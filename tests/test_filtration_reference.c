/* filtration.h against a slow reference: two lattices, one node after the other, every formula written out, links found
   node by node. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "filtration.h"

enum { N = 14 };
typedef struct reference {
    int q, c[19][3], opposite[19];
    double w[19], h[N][N][N][19], next[N][N][N][19];
    int solid[N][N][N];
} reference;

static void set_directions(reference *r, int q) {
    r->q = 0;
    for (int z = -1; z <= 1; z++)
        for (int y = -1; y <= 1; y++)
            for (int x = -1; x <= 1; x++) {
                const int cc = x * x + y * y + z * z;
                if (q == 19 ? cc == 3 : cc == 2) continue;
                r->c[r->q][0] = x, r->c[r->q][1] = y, r->c[r->q][2] = z;
                r->w[r->q++] = q == 19 ? (cc == 0   ? 1.0 / 3
                                          : cc == 1 ? 1.0 / 18
                                                    : 1.0 / 36)
                                       : (cc == 0   ? 2.0 / 9
                                          : cc == 1 ? 1.0 / 9
                                                    : 1.0 / 72);
            }
    for (int i = 0; i < q; i++)
        for (int j = 0; j < q; j++)
            if (r->c[i][0] == -r->c[j][0] && r->c[i][1] == -r->c[j][1] && r->c[i][2] == -r->c[j][2]) r->opposite[i] = j;
}

/* Collision by the moments' definitions: even and odd parts apart, the trace of the stress at its own rate,
   forcing by parity. */
static void collide(const reference *r, double *h, double tau, double bulk, const double F[3]) {
    const double plus = 1.0 / tau, minus = 1.0 / (0.5 + 3.0 / 16.0 / (tau - 0.5)),
                 rate = 1.0 / (0.5 + 4.5 * bulk * (tau - 0.5) / 3.0);
    double rho = 0.0, u[3] = {0.5 * F[0], 0.5 * F[1], 0.5 * F[2]}, trace = 0.0, out[19];
    for (int i = 0; i < r->q; i++) {
        rho += h[i];
        for (int a = 0; a < 3; a++) u[a] += r->c[i][a] * h[i];
    }
    const double uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2], uF = u[0] * F[0] + u[1] * F[1] + u[2] * F[2];
    for (int i = 0; i < r->q; i++)
        trace += h[i] * (r->c[i][0] * r->c[i][0] + r->c[i][1] * r->c[i][1] + r->c[i][2] * r->c[i][2]);
    trace -= rho + uu;
    for (int i = 0; i < r->q; i++) {
        const int *c = r->c[i], o = r->opposite[i], cc = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
        const double cu = c[0] * u[0] + c[1] * u[1] + c[2] * u[2], cF = c[0] * F[0] + c[1] * F[1] + c[2] * F[2];
        const double even = 0.5 * (h[i] + h[o]), odd = 0.5 * (h[i] - h[o]);
        out[i] = h[i] - plus * (even - r->w[i] * (rho + 4.5 * cu * cu - 1.5 * uu)) -
                 minus * (odd - r->w[i] * 3.0 * cu) +
                 r->w[i] * ((1.0 - 0.5 * plus) * (9.0 * cu * cF - 3.0 * uF) + 3.0 * (1.0 - 0.5 * minus) * cF) +
                 (plus - rate) * 1.5 * r->w[i] * (cc - 1.0) * (trace + uF);
    }
    memcpy(h, out, (size_t)r->q * sizeof *h);
}

static int wrap(int x) { return (x + N) % N; }

/* One step around a sphere at rest: central linear interpolation where the node behind is fluid, else half way. */
static void reference_step(reference *r, double tau, double bulk, const double F[3], const double centre[3],
                           double radius) {
    for (int k = 0; k < N * N * N; k++) collide(r, r->h[k / N / N][k / N % N][k % N], tau, bulk, F);
    for (int k = 0; k < N * N * N; k++) {
        const int p[3] = {k % N, k / N % N, k / N / N};
        if (r->solid[p[2]][p[1]][p[0]]) continue;
        const double *here = r->h[p[2]][p[1]][p[0]];
        for (int i = 0; i < r->q; i++) {
            const int *c = r->c[i], o = r->opposite[i],
                      to[3] = {wrap(p[0] + c[0]), wrap(p[1] + c[1]), wrap(p[2] + c[2])};
            const int from[3] = {wrap(p[0] - c[0]), wrap(p[1] - c[1]), wrap(p[2] - c[2])};
            if (!r->solid[to[2]][to[1]][to[0]]) {
                r->next[to[2]][to[1]][to[0]][i] = here[i];
                continue;
            }
            double low = 0.0, high = 1.0; /* the surface by halving */
            for (int b = 0; b < 60; b++) {
                const double q = 0.5 * (low + high), x = p[0] + q * c[0] - centre[0], y = p[1] + q * c[1] - centre[1],
                             z = p[2] + q * c[2] - centre[2];
                if (x * x + y * y + z * z > radius * radius) low = q;
                else high = q;
            }
            r->next[p[2]][p[1]][p[0]][o] = here[i];
            if (!r->solid[from[2]][from[1]][from[0]])
                r->next[p[2]][p[1]][p[0]][o] +=
                    (1.0 - 2.0 * low) / (1.0 + 2.0 * low) * (r->h[from[2]][from[1]][from[0]][i] - here[o]);
        }
    }
    memcpy(r->h, r->next, sizeof r->h);
}

static double largest_difference(int q, double tau, double bulk, int precision) {
    reference *r = (reference *)calloc(1, sizeof *r);
    filtration_fluid_def def = filtration_fluid_default_def();
    filtration_fluid fluid;
    const double F[3] = {2e-5, -1e-5, 3e-5}, centre[3] = {6.6, 6.9, 6.3}, lattice_radius = 3.7;
    def.nodes[0] = def.nodes[1] = def.nodes[2] = N;
    /* Lattice units are SI units. */
    def.voxel = 1.0, def.density = 1.0, def.tau = tau, def.viscosity = (tau - 0.5) / 3.0;
    def.bulk_ratio = bulk;
    def.lattice = q == 19 ? FILTRATION_D3Q19 : FILTRATION_D3Q15;
    def.precision = (filtration_precision)precision;
    memcpy(def.body_force, F, sizeof F);
    assert_int_equal(filtration_fluid_init(&fluid, &def), FILTRATION_OK);
    double place[3], zero[3] = {0, 0, 0}, radius = lattice_radius, force[3], torque[3], worst = 0.0, largest = 0.0;
    for (int a = 0; a < 3; a++) place[a] = centre[a] + 0.5;
    const filtration_spheres spheres = {1, place, zero, zero, &radius, force, torque};
    set_directions(r, q);
    for (int k = 0; k < N * N * N; k++) {
        const double x = k % N - centre[0], y = k / N % N - centre[1], z = k / N / N - centre[2];
        r->solid[k / N / N][k / N % N][k % N] = x * x + y * y + z * z < lattice_radius * lattice_radius;
    }
    for (int step = 0; step < 61; step++) {
        reference_step(r, tau, bulk, F, centre, lattice_radius);
        assert_int_equal(filtration_fluid_step(&fluid, &spheres), FILTRATION_OK);
    }
    for (int k = 0; k < N * N * N; k++) {
        filtration_sample s;
        const double *h = r->h[k / N / N][k / N % N][k % N];
        assert_int_equal(filtration_fluid_at(&fluid, k % N, k / N % N, k / N / N, &s), FILTRATION_OK);
        assert_int_equal(s.owner, r->solid[k / N / N][k / N % N][k % N] ? 0 : -1);
        for (int a = 0; a < 3 && s.owner == -1; a++) {
            double u = 0.5 * F[a];
            for (int i = 0; i < q; i++) u += r->c[i][a] * h[i];
            worst = fmax(worst, fabs(u - s.velocity[a]));
            largest = fmax(largest, fabs(u));
        }
    }
    filtration_fluid_free(&fluid);
    free(r);
    return worst / largest;
}

static void test_fast_equals_slow(void **state) {
    (void)state;
    const double taus[] = {0.6, 1.0, 3.5}, bulks[] = {2.0 / 3.0, 20.0};
    for (int t = 0; t < 3; t++)
        for (int b = 0; b < 2; b++) {
            assert_true(largest_difference(19, taus[t], bulks[b], FILTRATION_DOUBLE) < 1e-10);
            assert_true(largest_difference(15, taus[t], bulks[b], FILTRATION_DOUBLE) < 1e-10);
            assert_true(largest_difference(19, taus[t], bulks[b], FILTRATION_FLOAT) < 1e-4);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_fast_equals_slow)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
