/* classifier.h against slow and independent ways to the same numbers: 40-digit laws
   (tests/reference/classifier/laws.csv), enumeration of collision sequences, bisection, plain Monte Carlo written down
   as in the paper, step-by-step flight, brute-force averages. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "near.h"

#include "classifier.h"
#include "examples/common/csv.h"

#define LENGTH(array) ((int)(sizeof(array) / sizeof((array)[0])))
#define PI 3.14159265358979323846

/* ---- 40-digit laws ---- */

static classifier_balance balance(double v_radial, double v_phi) {
    classifier_balance at = {1.2, 1.81e-5, 2700.0, 0.025, v_radial, v_phi, false};
    return at;
}

static double law(const char *name, double a, double b, double c) {
    classifier_drag hs = classifier_hoelzer_sommerfeld(b, CLASSIFIER_EQUIVALENT),
                    hs_c = classifier_hoelzer_sommerfeld(c, CLASSIFIER_EQUIVALENT);
    classifier_drag sn = classifier_schiller_naumann();
    classifier_balance at = balance(a, b);
    if (!strcmp(name, "newton_factor")) return classifier_newton_factor(a);
    if (!strcmp(name, "hoelzer_sommerfeld")) return classifier_drag_coefficient(hs, a);
    if (!strcmp(name, "schiller_naumann")) return classifier_drag_coefficient(sn, a);
    if (!strcmp(name, "di_felice")) return classifier_di_felice_exponent(a);
    if (!strcmp(name, "cut_size")) return classifier_cut_size(&at, hs_c, NULL);
    if (!strcmp(name, "terminal_velocity")) return classifier_terminal_velocity(hs, a, 2700.0, 1.2, 1.81e-5, 9.81);
    if (!strcmp(name, "terminal_schiller_naumann"))
        return classifier_terminal_velocity(sn, a, 2700.0, 1.2, 1.81e-5, 9.81);
    if (!strcmp(name, "stopping_distance")) return classifier_stopping_distance(hs_c, a, 2700.0, 1.2, 1.81e-5, b);
    if (!strcmp(name, "stopping_schiller_naumann")) return classifier_stopping_distance(sn, a, 2700.0, 1.2, 1.81e-5, b);
    if (!strcmp(name, "normal_above")) return classifier__normal_above(a);
    if (!strcmp(name, "thornton_ning")) return classifier_thornton_ning(1.0 / a, 1.0);
    if (!strcmp(name, "molerus_hoffmann_size")) return classifier_molerus_hoffmann_size(a, 1.0, b);
    return (double)NAN;
}

static void laws_to_forty_digits(void **state) {
    (void)state;
    csv_data data;
    char message[200];
    if (csv_read("tests/reference/classifier/laws.csv", &data, message, sizeof message)) fail_msg("%s", message);
    assert_true(data.rows > 180);
    for (int i = 0; i < data.rows; i++) {
        const char *name = data.cells[i * data.columns + csv_column(&data, "law")];
        double value = csv_value(&data, i, "value");
        near_relative(law(name, csv_value(&data, i, "a"), csv_value(&data, i, "b"), csv_value(&data, i, "c")), value,
                      1e-12, name);
    }
    csv_free(&data);
}

/* ---- normal law: quantile is the inverse of the tail ---- */

static void normal_law_both_ways(void **state) {
    (void)state;
    for (double u = 1e-12; u < 1.0; u = u < 0.01 ? u * 1.7 : u + 0.0037)
        close_to(1.0 - classifier__normal_above(classifier__normal_at(u)), u, u < 1e-3 ? 1e-15 / u + 1e-13 : 1e-13);
    assert_true(classifier__normal_at(0.5) == 0.0 && classifier__normal_above(0.0) == 0.5);
}

/* ---- collision sequences ---- */

/* Slots W0 P1 W1 ... Pn Wn, each reverses the direction (-1) or not. Which of the 2^(2n+1) can happen and leave the
   wheel outward? */
static void count_sequences(int n, double counts[3]) {
    counts[0] = counts[1] = counts[2] = 0.0;
    for (unsigned long bits = 0; bits < 1ul << (2 * n + 1); bits++) {
        int inbound = 1, possible = 1, turned_by_particle = 0, last = 'P';
        for (int slot = 0; slot < 2 * n + 1 && possible; slot++) {
            if (!(bits >> slot & 1)) continue;
            int wall = slot % 2 == 0;
            possible = !wall || inbound; /* an outbound particle does not reach the face */
            inbound = !inbound;
            if (!wall) turned_by_particle = 1;
            last = wall ? 'W' : 'P';
        }
        if (!possible || inbound) continue;
        counts[!turned_by_particle ? 0 : last == 'P' ? 1 : 2] += 1.0;
    }
}

static void case_weights_by_enumeration(void **state) {
    (void)state;
    for (int n = 0; n <= 12; n++) {
        double counts[3];
        count_sequences(n, counts);
        double total = counts[0] + counts[1] + counts[2];
        classifier_weights w = classifier_weights_of(n);
        assert_true(fabs(w.clean - counts[0] / total) < 1e-15 && fabs(w.thrown - counts[1] / total) < 1e-15);
        assert_true(fabs(w.again - counts[2] / total) < 1e-15);
        if (n == 3) assert_true(counts[0] == 4.0 && counts[1] == 9.0 && counts[2] == 23.0 && total == 36.0);
        if (n == 7) assert_true(counts[0] == 8.0 && counts[1] == 729.0 && counts[2] == 2179.0 && total == 2916.0);
    }
}

/* The chain by enumeration of every branch with its probability */
static void walk(int slot, int slots, int inbound, int turned, int last_wall, double p, double counter, double wall,
                 double sums[3]) {
    if (p == 0.0) return;
    if (slot == slots) {
        if (!inbound) sums[!turned ? 0 : last_wall ? 2 : 1] += p;
        return;
    }
    if (slot % 2 == 0) {
        double hit = inbound ? wall : 0.0;
        walk(slot + 1, slots, 0, turned, 1, p * hit, counter, wall, sums);
        walk(slot + 1, slots, inbound, turned, last_wall, p * (1.0 - hit), counter, wall, sums);
    } else {
        walk(slot + 1, slots, !inbound, 1, 0, p * counter, counter, wall, sums);
        walk(slot + 1, slots, inbound, turned, last_wall, p * (1.0 - counter), counter, wall, sums);
    }
}

static void markov_weights_by_enumeration(void **state) {
    (void)state;
    const double chances[][2] = {{0.5, 0.5}, {0.2, 0.9}, {0.7, 1.0}, {1.0, 0.3}, {0.01, 0.02}};
    for (int i = 0; i < LENGTH(chances); i++)
        for (int n = 0; n <= 8; n++) {
            double sums[3] = {0.0, 0.0, 0.0}, counter = chances[i][0], wall = chances[i][1];
            walk(0, 2 * n + 1, 1, 0, 0, 1.0, counter, wall, sums);
            classifier_weights w = classifier_weights_markov(n, counter, wall);
            double total = sums[0] + sums[1] + sums[2];
            assert_true(fabs(w.clean - sums[0] / total) < 1e-14 && fabs(w.thrown - sums[1] / total) < 1e-14);
            assert_true(fabs(w.again - sums[2] / total) < 1e-14);
        }
}

static void mixtures_by_summation(void **state) {
    (void)state;
    const double means[] = {0.0, 0.05, 0.2, 1.0, 2.0, 7.5};
    for (int i = 0; i < LENGTH(means); i++) {
        double m = means[i], q = m / (1.0 + m), poisson = exp(-m), geometric = 1.0 - q, a[2] = {0.0, 0.0},
               b[2] = {0.0, 0.0};
        for (int n = 0; n < 400; n++) {
            classifier_weights w = classifier_weights_of(n);
            a[0] += poisson * w.clean;
            b[0] += poisson * w.thrown;
            a[1] += geometric * w.clean;
            b[1] += geometric * w.thrown;
            poisson *= m / (n + 1);
            geometric *= q;
        }
        classifier_weights p = classifier_weights_poisson(m), g = classifier_weights_geometric(m);
        assert_true(fabs(p.clean - a[0]) < 1e-14 && fabs(p.thrown - b[0]) < 1e-14 &&
                    fabs(p.clean + p.thrown + p.again - 1.0) < 1e-15);
        assert_true(fabs(g.clean - a[1]) < 1e-14 && fabs(g.thrown - b[1]) < 1e-14 &&
                    fabs(g.clean + g.thrown + g.again - 1.0) < 1e-15);
    }
}

/* ---- the solver: 1e7 random inputs, each answer is a root, and sampled ones agree with bisection ---- */

static uint64_t random_state = 88172645463325252u;
static double uniform(void) {
    random_state ^= random_state << 13;
    random_state ^= random_state >> 7;
    random_state ^= random_state << 17;
    return ((double)(random_state >> 11) + 0.5) / 9007199254740992.0;
}
static double gauss(void) { return sqrt(-2.0 * log(uniform())) * cos(6.283185307179586 * uniform()); }
static double spread(double low, double high) { return low * exp(uniform() * log(high / low)); }

static void solver_never_fails(void **state) {
    (void)state;
    int most = 0, bad = 0;
    double worst = 0.0, lowest = HUGE_VAL, highest = 0.0;
    for (int i = 0; i < 10000000; i++) {
        /* sphericities dense at both ends of (0, 1]; everything else over decades */
        double psi = i % 3 == 0 ? uniform() : i % 3 == 1 ? spread(1e-12, 1.0) : 1.0 - spread(1e-16, 0.5);
        classifier_drag drag = classifier_hoelzer_sommerfeld(psi, i & 1 ? CLASSIFIER_EQUIVALENT : CLASSIFIER_PROJECTED);
        /* a wanted Re gives the balance that has it, so that every Re from 1e-8 to 1e6 occurs */
        double wanted = spread(1e-8, 1e6), v_r = spread(1e-3, 1e3), radius = spread(1e-3, 10.0),
               rho_p = spread(10.0, 2e4);
        double x = wanted * 1.81e-5 / (1.2 * v_r);
        classifier_balance at = {1.2, 1.81e-5, rho_p, radius, v_r, 1.0, false};
        at.tangential_velocity =
            v_r * sqrt(0.75 * 1.2 / rho_p * radius * classifier_drag_coefficient(drag, wanted) / x);
        int iterations;
        double got = classifier_cut_size(&at, drag, &iterations), off = fabs(got / x - 1.0);
        if (!(off < 1e-13)) bad++;
        if (off > worst) worst = off;
        if (iterations > most) most = iterations;
        double re = 1.2 * v_r * got / 1.81e-5;
        if (re < lowest) lowest = re;
        if (re > highest) highest = re;
    }
    print_message("    1e7 inputs, Re %.1e .. %.1e: at most %d iterations, worst relative error %.1e\n", lowest,
                  highest, most, worst);
    assert_int_equal(bad, 0);
    assert_true(most <= 6);
}

static void solver_against_bisection(void **state) {
    (void)state;
    for (int i = 0; i < 4000; i++) {
        classifier_drag drags[] = {classifier_hoelzer_sommerfeld(spread(1e-3, 1.0), CLASSIFIER_EQUIVALENT),
                                   classifier_schiller_naumann(), classifier_stokes()};
        classifier_drag drag = drags[i % 3];
        classifier_balance at = {spread(0.1, 1000.0),
                                 spread(1e-6, 1e-2),
                                 spread(10.0, 2e4),
                                 spread(1e-3, 10.0),
                                 spread(1e-4, 100.0),
                                 spread(0.01, 300.0),
                                 false};
        double x = classifier_cut_size(&at, drag, NULL), low = log(1e-40), high = log(1e40);
        for (int k = 0; k < 200; k++) { /* the threshold falls with x: the cut is where it passes the velocity */
            double middle = 0.5 * (low + high);
            if (classifier_threshold_velocity(&at, drag, exp(middle)) > at.tangential_velocity) low = middle;
            else high = middle;
        }
        double re = at.fluid_density * at.radial_velocity * x / at.viscosity;
        close_to(x, exp(low),
                 drag.law == CLASSIFIER_SCHILLER_NAUMANN && fabs(re / 1000.0 - 1.0) < 0.01 ? 0.005 : 1e-12);
        /* the other unknowns take it back */
        if (drag.law == CLASSIFIER_SCHILLER_NAUMANN && fabs(re / 1000.0 - 1.0) < 0.01) continue;
        close_to(classifier_threshold_velocity(&at, drag, x), at.tangential_velocity, 1e-12);
        close_to(classifier_cut_radial_velocity(&at, drag, x), at.radial_velocity, 1e-12);
        /* d ln x / d ln K by a small change of the radius */
        classifier_balance more = at;
        more.radius *= 1.0001;
        close_to(log(classifier_cut_size(&more, drag, NULL) / x) / log(1.0001), classifier_cut_sensitivity(drag, re),
                 1e-4);
    }
}

/* ---- stopping distance: 2e5 explicit steps ---- */

static void stopping_step_by_step(void **state) {
    (void)state;
    classifier_drag drags[] = {classifier_hoelzer_sommerfeld(0.85, CLASSIFIER_EQUIVALENT),
                               classifier_schiller_naumann(), classifier_stokes(),
                               classifier_hoelzer_sommerfeld(0.02, CLASSIFIER_PROJECTED)};
    for (int k = 0; k < LENGTH(drags); k++) {
        double x = 2e-5, v = 39.0, mass = RIDDLE_PI / 6.0 * x * x * x * 2700.0, path = 0.0;
        /* midpoint rule in ln v: ds = m v dv / F */
        double step = 1e-4;
        while (v > 1e-7) {
            double middle = v * exp(-0.5 * step);
            path += mass * middle * middle * step / classifier_drag_force(drags[k], x, middle, 1.2, 1.81e-5);
            v *= exp(-step);
        }
        close_to(classifier_stopping_distance(drags[k], x, 2700.0, 1.2, 1.81e-5, 39.0), path, 1e-7);
    }
}

/* ---- approach: the flight in small steps ---- */

static void approach_step_by_step(void **state) {
    (void)state;
    classifier_def def = classifier_default_def();
    for (int i = 0; i < 200; i++) {
        double omega = spread(300.0, 2000.0), ahead = 0.04 + 0.18 * uniform(), v_t = gauss() + 1.0,
               v_r = fabs(gauss()) * 2.0 + 0.3;
        classifier_impact hit = classifier_approach(&def.wheel, omega, ahead, v_t, v_r);
        assert_true(hit.hit && hit.iterations <= 8);
        double x = 0.025 * cos(ahead), y = 0.025 * sin(ahead), vx = -v_r * cos(ahead) + v_t * sin(ahead),
               vy = -v_r * sin(ahead) - v_t * cos(ahead);
        double t = 0.0, step = 1e-3 / omega;
        for (int k = 0; k < 34; k++) { /* ever smaller steps up to the first crossing of the face */
            while (cos(omega * (t + step)) * (y + vy * (t + step)) - sin(omega * (t + step)) * (x + vx * (t + step)) >
                   0.001)
                t += step;
            step *= 0.5;
        }
        close_to(hit.time, t, 1e-9);
        double px = x + vx * t, py = y + vy * t, r = sqrt(px * px + py * py);
        close_to(hit.radius, r < 0.025 ? r : 0.025, 1e-12);
        double wx = vx + omega * py, wy = vy - omega * px, c = cos(omega * t), s = sin(omega * t);
        close_to(hit.speed, hypot(wx, wy), 1e-9);
        assert_true(fabs(tan(hit.angle) - (c * wx + s * wy) / (s * wx - c * wy)) < 1e-9);
    }
}

/* ---- the whole model as plain Monte Carlo with libm, written down from the paper ---- */

static double truncated(double mean, double sd, double low, double high) {
    for (;;) {
        double v = mean + sd * gauss();
        if (v >= low && v <= high) return v;
    }
}

static void approach_plainly(double omega, double v_t_mean, double v_r_mean, double *r, double *speed, double *angle) {
    double edge = asin(0.001 / 0.025), ahead = edge + uniform() * (2.0 * PI / 24.0 - 2.0 * edge);
    double v_t = v_t_mean + gauss(), v_r = truncated(v_r_mean, 0.5 * v_r_mean, 0.0, HUGE_VAL);
    double x = 0.025 * cos(ahead), y = 0.025 * sin(ahead), vx = -v_r * cos(ahead) + v_t * sin(ahead),
           vy = -v_r * sin(ahead) - v_t * cos(ahead);
    double low = 0.0, high = 0.5 / omega;
    for (int k = 0; k < 60; k++) {
        double t = 0.5 * (low + high);
        if (cos(omega * t) * (y + vy * t) - sin(omega * t) * (x + vx * t) > 0.001) low = t;
        else high = t;
    }
    double px = x + vx * low, py = y + vy * low, wx = vx + omega * py, wy = vy - omega * px, c = cos(omega * low),
           s = sin(omega * low);
    *r = fmin(hypot(px, py), 0.025);
    *speed = hypot(wx, wy);
    *angle = atan2(c * wx + s * wy, s * wx - c * wy);
}

static void model_by_plain_monte_carlo(void **state) {
    (void)state;
    const double rpm[] = {3000.0, 15000.0}, v_t[] = {1.5, 0.0}, v_r[] = {1.0, 4.5183}, chi[] = {2.7, 4.3},
                 sizes[][2] = {{50e-6, 65e-6}, {9e-6, 12e-6}};
    const int n = 200000;
    for (int k = 0; k < 2; k++) {
        double omega = rpm[k] * PI / 30.0, wanted[2] = {0.0, 0.0}, q = 0.5; /* geometric, mean 1 */
        for (int i = 0; i < n; i++) {
            double r, speed, angle, r2, speed2, angle2, theta, e = truncated(0.29, 0.15, 0.0, 1.0),
                                                               e2 = truncated(0.29, 0.15, 0.0, 1.0);
            approach_plainly(omega, v_t[k], v_r[k], &r, &speed, &angle);
            approach_plainly(omega, v_t[k], v_r[k], &r2, &speed2, &angle2);
            do theta = angle + 37.0 * PI / 180.0 * gauss();
            while (fabs(theta) >= 0.5 * PI);
            double v = omega * r + e * speed * cos(theta), other = v_t[k] + gauss();
            int contacts = 0;
            while (uniform() < q) contacts++;
            classifier_weights w = classifier_weights_of(contacts);
            double choose = uniform(), place = r;
            if (choose > w.clean + w.thrown) { /* C */
                double slowed = v - 0.645 * (v + other);
                place = r2;
                v = omega * r2 +
                    e2 * (omega * r2 - slowed) * cos(truncated(0.0, 37.0 * PI / 180.0, -0.5 * PI, 0.5 * PI));
            } else if (choose > w.clean) {
                v = -other + 0.645 * cos((2.0 * uniform() - 1.0) * 65.0 * PI / 180.0) * (v + other);
            }
            double psi = 1.075 * (0.83 + 0.04 * gauss()) - 0.067,
                   gas = chi[k] * 7.1 * (2.0 * PI * 0.025 - 0.048) / (2.0 * PI * place - 0.048);
            psi = fmin(fmax(psi, 0.5075), 0.9998);
            for (int j = 0; j < 2; j++) { /* outward if the centrifugal force wins */
                double x = sizes[k][j], re = 1.2 * gas * x / 1.81e-5;
                double cd = 24.0 / (re * sqrt(psi)) + 3.0 / (sqrt(re) * pow(psi, 0.75)) +
                            0.42 * pow(10.0, 0.4 * pow(-log10(psi), 0.2)) / psi;
                double out = 2700.0 * PI / 6.0 * x * x * x * v * v / place,
                       in = cd * PI / 4.0 * x * x * 0.6 * gas * gas;
                wanted[j] += (v > 0.0 && out >= in) / (double)n;
            }
        }
        classifier_def def = classifier_paper_def(CLASSIFIER_LIMESTONE, rpm[k], NULL);
        classifier_model model;
        assert_int_equal(classifier_init(&model, &def, NULL), CLASSIFIER_OK);
        for (int j = 0; j < 2; j++) {
            double error, t = classifier_tromp(&model, sizes[k][j], &error),
                          noise = sqrt(wanted[j] * (1.0 - wanted[j]) / n);
            assert_true(error < 5e-4 && wanted[j] > 0.1 && wanted[j] < 0.9);
            if (!(fabs(t - wanted[j]) < 4.0 * noise + error))
                fail_msg("%g rpm, %g um: T %.5f, plain %.5f +- %.5f", rpm[k], 1e6 * sizes[k][j], t, wanted[j], noise);
        }
        classifier_free(&model);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(laws_to_forty_digits),        cmocka_unit_test(normal_law_both_ways),
        cmocka_unit_test(case_weights_by_enumeration), cmocka_unit_test(markov_weights_by_enumeration),
        cmocka_unit_test(mixtures_by_summation),       cmocka_unit_test(solver_never_fails),
        cmocka_unit_test(solver_against_bisection),    cmocka_unit_test(stopping_step_by_step),
        cmocka_unit_test(approach_step_by_step),       cmocka_unit_test(model_by_plain_monte_carlo),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
