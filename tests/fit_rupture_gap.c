/* Fits the correction of eq 19, bridge_rupture_gap_unequal, to solutions of the Young-Laplace equation, and compares it
   with others that the fit has not seen: random ones, and kinds of contact angles that are common. Run by
   scripts/verify rupture_fit. Prints coefficients and deviations; leaves with 1 if the header's function is off by more
   than 1 % rms or 4 % in any.
       cc -O2 -I. tests/fit_rupture_gap.c -lm && ./a.out [BRIDGES] */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "liquid_bridge.h"
#include "../examples/common/random.h"

enum { TERMS = 35, ROUNDS = 80 }; /* of a cubic in four variables */

typedef struct bridge_case {
    double ratio, volume, small, large, gap; /* radii [-], V/R_h^3 [-], angles [rad], rupture gap over R_h [-] */
} bridge_case;

/* Solves the case for its gap; 0 if it has none. */
static int solved(bridge_case *c) {
    bridge_pair_def def = bridge_pair_default_def();
    bridge_shape shape = {0};
    double fold;
    def.radius_i = 1.0, def.radius_j = c->ratio > 0.0 ? 1.0 / c->ratio : (double)INFINITY;
    def.angle_i = c->small, def.angle_j = c->large;
    const double radius = bridge_harmonic_radius(1.0, def.radius_j);
    if (bridge_young_laplace_rupture(&def, c->volume * radius * radius * radius, &shape, &fold) != BRIDGE_OK) return 0;
    c->gap = shape.gap / radius;
    return 1;
}

/* Angles to 50 degrees, every fourth one a multiple of 15, some alike; V/R_h^3 from 1e-6 to 0.1; a plate in 20 of 100,
   as many equal spheres. Unsolved ones are drawn anew. */
static bridge_case draw(uint64_t *random) {
    for (;;) {
        bridge_case c;
        double angle[2];
        const double kind = random_share(random);
        c.ratio = kind < 0.2 ? 0.0 : kind < 0.4 ? 1.0 : random_share(random);
        c.volume = exp(log(1e-6) + random_share(random) * log(1e5));
        for (int k = 0; k < 2; k++) {
            angle[k] = 50.0 * random_share(random);
            if (random_share(random) < 0.25) angle[k] = 15.0 * floor(angle[k] / 15.0 + 0.5);
        }
        if (random_share(random) < 0.15) angle[1] = angle[0];
        c.small = angle[0] * RIDDLE_PI / 180.0, c.large = angle[1] * RIDDLE_PI / 180.0;
        /* Equal spheres: the smaller angle is called that of the smaller one. */
        if (c.ratio == 1.0 && c.small > c.large) {
            const double swapped = c.small;
            c.small = c.large, c.large = swapped;
        }
        if (solved(&c)) return c;
    }
}

/* The products of up to three of k, v, angle_small, angle_large, in the order in which the header takes them. */
static void terms_of(const bridge_case *c, double *x) {
    const double v[4] = {c->ratio, 2.0 * cbrt(c->volume), 1.25 * c->small, 1.25 * c->large};
    int n = 0;
    for (int a = 0; a <= 3; a++)
        for (int b = 0; a + b <= 3; b++)
            for (int e = 0; a + b + e <= 3; e++)
                for (int f = 0; a + b + e + f <= 3; f++)
                    x[n++] = pow(v[0], a) * pow(v[1], b) * pow(v[2], e) * pow(v[3], f);
}

static double sum_of(const double *coefficients, const double *x) {
    double sum = 0.0;
    for (int r = 0; r < TERMS; r++) sum += coefficients[r] * x[r];
    return sum;
}

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

/* The bridge lets go of one sphere or of the other, so the logarithm of the correction is the smaller of two cubics.
   Each round fits both to the bridges that belong to it, with more weight for those that it misses most. */
static void fit(const bridge_case *cases, int n, double branch[2][TERMS]) {
    double x[TERMS];
    for (int round = 0; round < ROUNDS; round++) {
        double a[2][TERMS][TERMS + 1] = {{{0.0}}};
        for (int i = 0; i < n; i++) {
            const bridge_case *c = &cases[i];
            const double y = log(c->gap / bridge_rupture_gap(c->volume, 1.0, c->ratio, c->small, c->large));
            terms_of(c, x);
            const double p = sum_of(branch[0], x), q = sum_of(branch[1], x);
            const int at = round == 0 ? c->large - c->small > 0.28 : round < 20 ? fabs(q - y) < fabs(p - y) : q < p;
            const double miss = ((p < q ? p : q) - y) / 0.007,
                         weight = round < 20 ? 1.0 : 1.0 + fmin(miss * miss * miss * miss, 60.0);
            for (int r = 0; r < TERMS; r++) {
                for (int s = 0; s < TERMS; s++) a[at][r][s] += weight * x[r] * x[s];
                a[at][r][TERMS] += weight * x[r] * y;
            }
        }
        for (int k = 0; k < 2; k++) {
            for (int r = 0; r < TERMS; r++) a[k][r][r] += 1e-9;
            solve(a[k]);
            for (int r = 0; r < TERMS; r++) branch[k][r] = a[k][r][TERMS];
        }
    }
}

typedef struct misses {
    double squares, most;
    int n;
} misses;
static void miss(misses *m, double value, double truth) {
    m->squares += (value / truth - 1.0) * (value / truth - 1.0), m->most = fmax(m->most, fabs(value / truth - 1.0)),
                                                                 m->n++;
}
static void say(const char *name, const misses *m) {
    printf("%-34s %5d bridges, off by %.2f %% rms, at most %.2f %%\n", name, m->n, 100.0 * sqrt(m->squares / m->n),
           100.0 * m->most);
}

int main(int argc, char **argv) {
    const int n = argc > 1 ? atoi(argv[1]) : 12000;
    const double kinds[12][2] = {{0, 0},  {15, 15}, {30, 30}, {40, 40}, {0, 15},  {0, 30},
                                 {0, 45}, {15, 30}, {15, 45}, {15, 50}, {30, 45}, {45, 15}};
    uint64_t random = 77;
    static double branch[2][TERMS];
    double x[TERMS];
    misses eq_19 = {0}, fitted = {0}, header = {0}, common = {0};
    bridge_case *cases = malloc((size_t)n * sizeof *cases);
    if (!cases || n < 1000) return 2;
    for (int i = 0; i < n; i++) cases[i] = draw(&random);
    fit(cases, n, branch);
    for (int k = 0; k < 2; k++)
        for (int r = 0; r < TERMS; r++)
            printf("%s%.5f%s", r % 7 ? " " : "", branch[k][r], r == TERMS - 1 ? "\n\n" : r % 7 == 6 ? ",\n" : ",");
    free(cases);
    random = 991;
    for (int i = 0; i < n / 3; i++) {
        const bridge_case c = draw(&random);
        const double plain = bridge_rupture_gap(c.volume, 1.0, c.ratio, c.small, c.large);
        terms_of(&c, x);
        miss(&eq_19, plain, c.gap);
        miss(&fitted, plain * exp(fmin(sum_of(branch[0], x), sum_of(branch[1], x))), c.gap);
        miss(&header, bridge_rupture_gap_unequal(c.volume, 1.0, c.ratio, c.small, c.large), c.gap);
    }
    for (int k = 0; k < 12; k++)
        for (int r = 0; r <= 10; r++)
            for (int v = 0; v <= 10; v++)
                for (int turn = 0; turn < 2; turn++) {
                    bridge_case c;
                    c.ratio = r / 10.0, c.volume = 1e-6 * pow(10.0, 0.5 * v);
                    c.small = kinds[k][turn] * RIDDLE_PI / 180.0, c.large = kinds[k][1 - turn] * RIDDLE_PI / 180.0;
                    if (solved(&c))
                        miss(&common, bridge_rupture_gap_unequal(c.volume, 1.0, c.ratio, c.small, c.large), c.gap);
                }
    say("eq 19, random", &eq_19), say("this fit, random", &fitted), say("the header, random", &header),
        say("the header, common kinds", &common);
    return !(sqrt(header.squares / header.n) < 0.01 && header.most < 0.04 && sqrt(common.squares / common.n) < 0.01 &&
             common.most < 0.04);
}
