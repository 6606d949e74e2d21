/* liquid_bridge.h against tables computed elsewhere (tests/reference/liquid_bridge) and against a slow solver of its
   own kind: the meridian of the meniscus, integrated step by step. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "liquid_bridge.h"

#define FOLDER "tests/reference/liquid_bridge/"
#define DEGREES (RIDDLE_PI / 180.0)

/* Of long tables every so many rows are compared. The numbers are the same with and without sanitizers, which
   look at memory. */
#ifdef __has_feature
#if __has_feature(address_sanitizer)
#define EVERY 8
#endif
#endif
#ifdef __SANITIZE_ADDRESS__
#define EVERY 8
#endif
#ifndef EVERY
#define EVERY 1
#endif

static csv_data table_of(const char *name) {
    char path[200], message[300];
    csv_data data;
    snprintf(path, sizeof path, FOLDER "%s", name);
    if (csv_read(path, &data, message, sizeof message) != 0) fail_msg("%s", message);
    return data;
}

/* A number of row r, `inf` included. */
static double number(const csv_data *data, int r, const char *column) {
    int c = csv_column(data, column);
    if (c < 0) fail_msg("no column %s", column);
    const char *cell = data->cells[r * data->columns + c];
    return strcmp(cell, "inf") == 0 ? (double)INFINITY : (*cell ? strtod(cell, NULL) : (double)NAN);
}

static bridge_pair_def solids(double ri, double rj, double degrees_i, double degrees_j) {
    bridge_pair_def def = bridge_pair_default_def();
    def.radius_i = ri;
    def.radius_j = rj;
    def.angle_i = degrees_i * DEGREES;
    def.angle_j = degrees_j * DEGREES;
    def.liquid.surface_tension = 1.0;
    return def;
}

static double off(double got, double wanted) { return fabs(got / wanted - 1.0); }

/* 14 bridges, 27 gaps each, 12 digits. */
static void test_force_to_1e_9(void **state) {
    (void)state;
    csv_data t = table_of("young_laplace_force.csv");
    double force = 0.0, pressure = 0.0, neck = 0.0, filling = 0.0;
    assert_int_equal(t.rows, 378);
    for (int r = 0; r < t.rows; r++) {
        bridge_pair_def def =
            solids(number(&t, r, "r1"), number(&t, r, "r2"), number(&t, r, "theta1_deg"), number(&t, r, "theta2_deg"));
        bridge_shape s = {0};
        assert_int_equal(bridge_young_laplace(&def, number(&t, r, "V"), number(&t, r, "S"), &s), BRIDGE_OK);
        force = fmax(force, off(s.force / (2.0 * RIDDLE_PI), number(&t, r, "F_over_2pi_sigma_r1")));
        pressure = fmax(pressure, off(s.pressure, number(&t, r, "dp_r1_over_sigma")));
        neck = fmax(neck, off(s.neck, number(&t, r, "neck_y0")));
        filling = fmax(filling, off(s.filling_i, number(&t, r, "phi1_rad")));
        if (!isnan(number(&t, r, "phi2_rad")) && !isinf(def.radius_j))
            filling = fmax(filling, off(s.filling_j, number(&t, r, "phi2_rad")));
    }
    print_message("    off by: force %.2g, pressure %.2g, neck %.2g, filling angle %.2g\n", force, pressure, neck,
                  filling);
    assert_true(force < 1e-9 && pressure < 1e-9 && neck < 1e-9 && filling < 1e-9);
    csv_free(&t);
}

static void test_rupture_to_1e_9(void **state) {
    (void)state;
    csv_data t = table_of("young_laplace_rupture.csv");
    double gap = 0.0, force = 0.0, contact = 0.0, instability = 0.0;
    int unstable = 0;
    assert_int_equal(t.rows, 14);
    for (int r = 0; r < t.rows; r++) {
        bridge_pair_def def =
            solids(number(&t, r, "r1"), number(&t, r, "r2"), number(&t, r, "theta1_deg"), number(&t, r, "theta2_deg"));
        double V = number(&t, r, "V"), fold = 0.0, first = t.values[r * t.columns + t.columns - 1];
        bridge_shape rupture = {0}, s = {0};
        assert_int_equal(bridge_young_laplace_rupture(&def, V, &rupture, &fold), BRIDGE_OK);
        gap = fmax(gap, off(fold, number(&t, r, "Srup_YL")));
        if (isnan(first)) {
            assert_true(rupture.gap == fold);
            force = fmax(force, off(rupture.force / (2.0 * RIDDLE_PI), number(&t, r, "F_at_rupture_over_2pi_sigma")));
        } else {
            instability = fmax(instability, off(rupture.gap, first));
            unstable++;
        }
        assert_int_equal(bridge_young_laplace(&def, V, 0.0, &s), BRIDGE_OK);
        contact = fmax(contact, off(s.force / (2.0 * RIDDLE_PI), number(&t, r, "F_contact_over_2pi_sigma")));
        double eq19 =
            bridge_rupture_gap(V, bridge_harmonic_radius(def.radius_i, def.radius_j),
                               isinf(def.radius_j) ? 0.0 : def.radius_i / def.radius_j, def.angle_i, def.angle_j);
        assert_true(off(eq19, number(&t, r, "Srup_willett_eq19_harmonic")) < 1e-7);
    }
    print_message("    off by: fold %.2g, force there %.2g, contact %.2g; %d first instabilities, off by %.2g (six "
                  "digits given)\n",
                  gap, force, contact, unstable, instability);
    assert_true(gap < 1e-9 && force < 1e-9 && contact < 1e-9 && instability < 1e-5 && unstable == 3);
    csv_free(&t);
}

/* The neck splits, solved, and by the table of a prepared pair, either way round. */
static void test_neck_split(void **state) {
    (void)state;
    csv_data t = table_of("neck_split.csv");
    double solved = 0.0, tabulated = 0.0;
    assert_int_equal(t.rows, 50);
    for (int r = 0; r < t.rows; r += EVERY) {
        bridge_pair_def def =
            solids(number(&t, r, "r1"), number(&t, r, "r2"), number(&t, r, "theta1"), number(&t, r, "theta2"));
        double V = number(&t, r, "V"), fold = 0.0, share = number(&t, r, "share_1_at_rupture");
        bridge_shape s = {0};
        assert_int_equal(bridge_young_laplace_rupture(&def, V, &s, &fold), BRIDGE_OK);
        assert_true(off(fold, number(&t, r, "Srup")) < 1e-9);
        solved = fmax(solved, fabs(s.share_i - share));
        def.volume_max = 0.02;
        bridge_pair pair;
        bridge b;
        assert_int_equal(bridge_pair_prepare(&pair, &def), BRIDGE_OK);
        assert_int_equal(bridge_form(&pair, def.radius_i, def.radius_j, V, 0.0, 0, &b), BRIDGE_OK);
        tabulated = fmax(tabulated, fabs(b.split - share));
        assert_int_equal(bridge_form(&pair, def.radius_j, def.radius_i, 0.0, V, 1, &b), BRIDGE_OK);
        tabulated = fmax(tabulated, fabs(b.split - (1.0 - share)));
    }
    print_message("    neck split off by: solved %.2g, tabulated %.2g\n", solved, tabulated);
    assert_true(solved < 1e-9 && tabulated < 2e-3);
    csv_free(&t);
}

/* Rupture of unequal contact angles: solved, tabulated, and by the closed forms. */
static void test_unequal_angles(void **state) {
    (void)state;
    csv_data t = table_of("rupture_unequal_angles.csv");
    double fold_off = 0.0, contact = 0.0, sum_table = 0.0, sum_19 = 0.0, sum_corrected = 0.0, sum_equal = 0.0;
    int unequal = 0, equal = 0, instabilities = 0;
    for (int r = 0; r < t.rows; r += EVERY) {
        /* k, V/R_h^3, small, large, fold, F, F contact, share, first instability */
        const double *row = t.values + r * t.columns;
        bridge_pair_def def = solids(1.0, row[0] > 0.0 ? 1.0 / row[0] : (double)INFINITY, row[2], row[3]);
        double R = bridge_harmonic_radius(1.0, def.radius_j), V = row[1] * R * R * R, fold = 0.0;
        bridge_shape s = {0}, c = {0};
        assert_int_equal(bridge_young_laplace_rupture(&def, V, &s, &fold), BRIDGE_OK);
        assert_int_equal(bridge_young_laplace(&def, V, 0.0, &c), BRIDGE_OK);
        if (isnan(row[4])) continue; /* not solved there; here it is */
        fold_off = fmax(fold_off, off(fold / R, row[4]));
        contact = fmax(contact, off(c.force / (2.0 * RIDDLE_PI * R), row[6]));
        if (s.gap == fold)
            assert_true(fabs(s.share_i - row[7]) < 1e-8 && off(s.force / (2.0 * RIDDLE_PI * R), row[5]) < 1e-8);
        if (!isnan(row[8])) {
            assert_true(off(s.gap / fold, row[8]) < 1e-4);
            instabilities++;
        }
        bridge_pair pair;
        bridge b;
        double e19 = bridge_rupture_gap(V, R, row[0], def.angle_i, def.angle_j) / s.gap - 1.0;
        double e20 = bridge_rupture_gap_unequal(V, R, row[0], def.angle_i, def.angle_j) / s.gap - 1.0;
        assert_int_equal(bridge_pair_prepare(&pair, &def), BRIDGE_OK);
        assert_int_equal(bridge_form(&pair, 1.0, def.radius_j, V, 0.0, 0, &b), BRIDGE_OK);
        assert_true(fabs(e20) < 0.04); /* equal angles, too */
        if (row[2] == row[3]) {
            sum_equal += e19 * e19;
            equal++;
            continue;
        }
        sum_table += (b.rupture_gap / s.gap - 1.0) * (b.rupture_gap / s.gap - 1.0);
        sum_19 += e19 * e19;
        sum_corrected += e20 * e20;
        unequal++;
    }
    print_message("    %d bridges: fold off by %.2g, contact force by %.2g. Unequal angles, rms: table %.3f %%, eq 19 "
                  "%.1f %%, corrected "
                  "%.2f %%; equal, eq 19: %.1f %%\n",
                  unequal + equal, fold_off, contact, 100.0 * sqrt(sum_table / unequal), 100.0 * sqrt(sum_19 / unequal),
                  100.0 * sqrt(sum_corrected / unequal), 100.0 * sqrt(sum_equal / equal));
    assert_true(unequal > 200 / EVERY && fold_off < 1e-9 && contact < 1e-9);
    assert_true(sqrt(sum_table / unequal) < 0.01); /* 4 % asked for */
    assert_true(sqrt(sum_corrected / unequal) < 0.01);
    assert_true(EVERY > 1 || instabilities > 0); /* they are rare */
    csv_free(&t);
}

/* The global Chebyshev table of the specification: ln(F/F_energy) in (k, ln V, theta, t). It is another fit to
   other solutions. */
static double chebyshev_table(const csv_data *t, double k, double v, double theta, double tau) {
    double x[4] = {2.0 * k - 1.0, 2.0 * (log(v) - log(1e-6)) / (log(0.1) - log(1e-6)) - 1.0, 2.0 * theta / 52.0 - 1.0,
                   2.0 * tau - 1.0},
           sum = 0.0;
    for (int r = 0; r < t->rows; r++) {
        const double *row = t->values + r * t->columns;
        double term = row[4];
        for (int d = 0; d < 4; d++) term *= cos(row[d] * acos(fmax(-1.0, fmin(1.0, x[d]))));
        sum += term;
    }
    return sum;
}

static void test_against_the_global_table(void **state) {
    (void)state;
    csv_data t = table_of("chebyshev_force_4x6x4x8.csv");
    double worst = 0.0, sum = 0.0;
    int n = 0;
    assert_int_equal(t.rows, 768);
    const double ratios[] = {1.0, 0.7, 0.25, 0.0};
    for (int k = 0; k < 4; k++)
        for (double degrees = 5.0; degrees < 28.0; degrees += 7.0 * EVERY) {
            bridge_pair_def def = solids(1.0, ratios[k] > 0.0 ? 1.0 / ratios[k] : (double)INFINITY, degrees, degrees);
            bridge_pair pair;
            assert_int_equal(bridge_pair_prepare(&pair, &def), BRIDGE_OK);
            for (double v = 3e-6; v < 0.09; v *= 7.0) {
                double V = v * pair.radius * pair.radius * pair.radius;
                bridge b;
                assert_int_equal(bridge_form(&pair, 1.0, def.radius_j, V, 0.0, 0, &b), BRIDGE_OK);
                for (double x = 0.0; x <= 0.9; x += 0.15) {
                    double gap = x * b.rupture_gap;
                    double energy = bridge_force_energy(gap, V, pair.radius, def.angle_i, def.angle_j, 1.0);
                    double e = bridge_attraction(&b, gap) /
                                   (energy * exp(chebyshev_table(&t, ratios[k], v, degrees, sqrt(1.0 - x)))) -
                               1.0;
                    worst = fmax(worst, fabs(e));
                    sum += e * e;
                    n++;
                }
            }
        }
    print_message("    %d forces: rms %.3f %%, at most %.2f %% from the global table\n", n, 100.0 * sqrt(sum / n),
                  100.0 * worst);
    assert_true(sqrt(sum / n) < 1e-3 && worst < 5e-3);
    csv_free(&t);
}

/* ---- the slow solver ---- */

typedef struct meridian {
    double x, y, psi, volume, area;
} meridian;

static meridian slope_of(meridian m, double K) {
    meridian d = {cos(m.psi), sin(m.psi), cos(m.psi) / m.y - K, RIDDLE_PI * m.y * m.y * cos(m.psi),
                  2.0 * RIDDLE_PI * m.y};
    return d;
}

static meridian moved(meridian m, double h, meridian d) {
    meridian r = {m.x + h * d.x, m.y + h * d.y, m.psi + h * d.psi, m.volume + h * d.volume, m.area + h * d.area};
    return r;
}

/* Runge-Kutta along the arc: the meridian of mean curvature K that starts level at the neck. */
static meridian integrated(double neck, double K, double length) {
    meridian m = {0.0, neck, 0.0, 0.0, 0.0};
    const int steps = 4000;
    double h = length / steps;
    for (int n = 0; n < steps; n++) {
        meridian a = slope_of(m, K), b = slope_of(moved(m, 0.5 * h, a), K), c = slope_of(moved(m, 0.5 * h, b), K),
                 d = slope_of(moved(m, h, c), K);
        m = moved(moved(moved(moved(m, h / 6.0, a), h / 3.0, b), h / 3.0, c), h / 6.0, d);
    }
    return m;
}

/* A solution of the header is taken by its neck and pressure only; the meniscus is then integrated to the wetted circle
   of each solid, and contact angle, gap, volume, force and energy are compared. Nothing of the closed form is used. */
static void test_against_step_by_step_integration(void **state) {
    (void)state;
    const double kinds[][5] = {{1, 1, 15, 15, 1e-2},
                               {1, 3, 0, 0, 1e-3},
                               {1, (double)INFINITY, 15, 45, 1e-2},
                               {1, (double)INFINITY, 45, 15, 0.4},
                               {1, 1.5, 40, 10, 5e-2},
                               {1, 1, 35, 35, 1e-1},
                               {1, (double)INFINITY, 0, 0, 1e-4},
                               {1, 8, 25, 50, 2e-2}};
    double worst = 0.0;
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        bridge_pair_def def = solids(kinds[k][0], kinds[k][1], kinds[k][2], kinds[k][3]);
        bridge_shape last, s;
        assert_int_equal(bridge_young_laplace_rupture(&def, kinds[k][4], &last, NULL), BRIDGE_OK);
        for (int g = 0; g < 4; g++) {
            double gap = last.gap * (double[]){0.0, 0.2, 0.7, 0.98}[g], heights = 0.0, volume = 0.0, energy = 0.0;
            assert_int_equal(bridge_young_laplace(&def, kinds[k][4], gap, &s), BRIDGE_OK);
            for (int side = 0; side < 2; side++) {
                double R = side ? def.radius_j : def.radius_i, theta = side ? def.angle_j : def.angle_i,
                       ring = side ? s.ring_j : s.ring_i;
                /* psi there */
                double at_ring = isinf(R) ? 0.5 * RIDDLE_PI - theta : 0.5 * RIDDLE_PI - theta - asin(ring / R);
                /* the arc's length, by secant, from where it is widest just short of the ring; behind the
                   neck for psi < 0 */
                double sign = at_ring < 0.0 ? -1.0 : 1.0, l0 = 0.0, y0 = s.neck, l1 = sign * 0.02 * ring;
                meridian m = integrated(s.neck, s.pressure, l1);
                while (m.y < ring) {
                    l0 = l1;
                    y0 = m.y;
                    l1 += sign * 0.02 * ring;
                    m = integrated(s.neck, s.pressure, l1);
                }
                for (int n = 0; n < 60 && fabs(m.y - ring) > 1e-15 * ring && m.y != y0; n++) {
                    double next = l1 - (m.y - ring) * (l1 - l0) / (m.y - y0);
                    l0 = l1;
                    y0 = m.y;
                    l1 = next;
                    m = integrated(s.neck, s.pressure, l1);
                }
                worst = fmax(worst, fabs(m.psi - at_ring));
                double cosine = isinf(R) ? 1.0 : cos(asin(ring / R)),
                       cap = isinf(R) ? 0.0 : ring * ring / (R * (1.0 + cosine));
                heights += m.x - cap;
                volume += m.volume - RIDDLE_PI * cap * (3.0 * ring * ring + cap * cap) / 6.0;
                energy += m.area - cos(theta) * 2.0 * RIDDLE_PI * ring * ring / (1.0 + cosine);
                /* at the ring, not at the neck */
                double force = 2.0 * RIDDLE_PI * (m.y * cos(m.psi) - 0.5 * s.pressure * m.y * m.y);
                worst = fmax(worst, off(force, s.force));
            }
            worst = fmax(worst, fabs(heights - gap) / last.gap);
            worst = fmax(worst, off(volume, kinds[k][4]));
            worst = fmax(worst, off(energy, s.energy));
        }
    }
    print_message("    contact angles, gap, volume, force and energy agree to %.2g\n", worst);
    assert_true(worst < 2e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_force_to_1e_9),
        cmocka_unit_test(test_rupture_to_1e_9),
        cmocka_unit_test(test_neck_split),
        cmocka_unit_test(test_unequal_angles),
        cmocka_unit_test(test_against_the_global_table),
        cmocka_unit_test(test_against_step_by_step_integration),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
