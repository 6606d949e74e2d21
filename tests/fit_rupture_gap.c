/* Fits the correction of eq 19 for unequal contact angles, bridge_rupture_gap_unequal, to solutions of the Young-Laplace equation, and
   compares both with others that the fit has not seen. Run by scripts/verify rupture_fit. Prints coefficients and deviations; leaves with 1
   if the header's function is off by more than 3 % rms.
       cc -O2 -I. tests/fit_rupture_gap.c -lm && ./a.out [BRIDGES] */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "liquid_bridge.h"

enum { TERMS = 7 };

static double uniform(uint64_t *random) {
    uint64_t z = *random += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

typedef struct bridge_case {
    double ratio, volume, small, large, gap; /* radii [-], V/R_h^3 [-], angles [rad], rupture gap over R_h [-] */
} bridge_case;

/* Angles to 45 degrees, every other one a multiple of 15; V/R_h^3 from 1e-6 to 0.1; a plate in 15 of 100. Unsolved ones are drawn anew. */
static bridge_case draw(uint64_t *random) {
    for (;;) {
        bridge_case c;
        double angle[2];
        c.ratio = uniform(random) < 0.15 ? 0.0 : uniform(random);
        c.volume = exp(log(1e-6) + uniform(random) * log(1e5));
        for (int k = 0; k < 2; k++) {
            angle[k] = 0.25 * RIDDLE_PI * uniform(random);
            if (uniform(random) < 0.5) angle[k] = floor(12.0 * angle[k] / RIDDLE_PI + 0.5) * RIDDLE_PI / 12.0;
        }
        c.small = angle[0], c.large = angle[1];
        bridge_pair_def def = bridge_pair_default_def();
        bridge_shape shape = {0};
        double fold;
        def.radius_i = 1.0, def.radius_j = c.ratio > 0.0 ? 1.0 / c.ratio : (double)INFINITY;
        def.angle_i = c.small, def.angle_j = c.large;
        const double radius = bridge_harmonic_radius(1.0, def.radius_j);
        if (c.small == c.large) continue;
        if (bridge_young_laplace_rupture(&def, c.volume * radius * radius * radius, &shape, &fold) != BRIDGE_OK) continue;
        c.gap = shape.gap / radius;
        return c;
    }
}

static void terms_of(const bridge_case *c, double *x) {
    const double q = c->large - c->small, d = fabs(q), v = cbrt(c->volume), m = 0.5 * (c->large + c->small), k = c->ratio;
    x[0] = q * v, x[1] = q * d * v * k;
    x[2] = m * d * k, x[3] = m * d * v;
    x[4] = m * d * d, x[5] = m * d * d * k, x[6] = m * d * d * k * v;
}

/* Solves a[n][n + 1] by elimination with pivots; the answer is left in its last column. */
static void solve(double a[TERMS][TERMS + 1]) {
    for (int p = 0; p < TERMS; p++) {
        int best = p;
        for (int r = p; r < TERMS; r++) best = fabs(a[r][p]) > fabs(a[best][p]) ? r : best;
        for (int c = 0; c <= TERMS; c++) {
            const double t = a[p][c];
            a[p][c] = a[best][c], a[best][c] = t;
        }
        for (int r = 0; r < TERMS; r++) {
            const double factor = a[r][p] / a[p][p];
            for (int c = p; c <= TERMS && r != p; c++) a[r][c] -= factor * a[p][c];
        }
    }
    for (int p = 0; p < TERMS; p++) a[p][TERMS] /= a[p][p];
}

int main(int argc, char **argv) {
    const int n = argc > 1 ? atoi(argv[1]) : 4000;
    uint64_t random = 77;
    double a[TERMS][TERMS + 1] = {{0.0}}, x[TERMS], fitted = 0.0, header = 0.0, eq_19 = 0.0, worst = 0.0;
    for (int i = 0; i < n; i++) {
        const bridge_case c = draw(&random);
        const double y = log(c.gap / bridge_rupture_gap(c.volume, 1.0, c.ratio, c.small, c.large));
        terms_of(&c, x);
        for (int r = 0; r < TERMS; r++) {
            for (int s = 0; s < TERMS; s++) a[r][s] += x[r] * x[s];
            a[r][TERMS] += x[r] * y;
        }
    }
    solve(a);
    printf("q v, q d v k, m d k, m d v, m d^2, m d^2 k, m d^2 k v:");
    for (int r = 0; r < TERMS; r++) printf(" %.5f", a[r][TERMS]);
    random = 991;
    for (int i = 0; i < n; i++) {
        const bridge_case c = draw(&random);
        double y = 0.0;
        terms_of(&c, x);
        for (int r = 0; r < TERMS; r++) y += a[r][TERMS] * x[r];
        const double plain = bridge_rupture_gap(c.volume, 1.0, c.ratio, c.small, c.large), now = plain * exp(y) / c.gap - 1.0;
        const double own = bridge_rupture_gap_unequal(c.volume, 1.0, c.ratio, c.small, c.large) / c.gap - 1.0;
        fitted += now * now, header += own * own, eq_19 += (plain / c.gap - 1.0) * (plain / c.gap - 1.0);
        worst = fmax(worst, fabs(own));
    }
    header = sqrt(header / n);
    printf("\n%d bridges, off by rms: eq 19 %.2f %%, this fit %.2f %%, the header %.2f %%, at most %.1f %%\n", n, 100.0 * sqrt(eq_19 / n),
           100.0 * sqrt(fitted / n), 100.0 * header, 100.0 * worst);
    return !(header < 0.03);
}
