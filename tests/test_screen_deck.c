/* examples/screen_deck/deck_scene.h, deck_measure.h: the machine of screen_deck: its geometry and motion, its books,
   its steady state. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <stdio.h>

#include "../examples/screen_deck/deck_measure.h"
#include "../examples/common/random.h"

/* ---- statistics ---- */

static void test_student(void **state) {
    (void)state;
    static const int freedom[] = {1, 2, 3, 4, 5, 7, 9, 15, 30, 100};
    static const double table[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.365, 2.262, 2.131, 2.042, 1.984};
    for (int k = 0; k < 10; k++)
        if (!(fabs(deck_student(freedom[k]) / table[k] - 1.0) < 1.5e-3))
            fail_msg("t of %d: %g", freedom[k], deck_student(freedom[k]));
}

/* Intervals of means and ratios hold the truth as often as they say. */
static void test_intervals_cover(void **state) {
    (void)state;
    enum { TRIALS = 4000, N = DECK_BATCHES };
    uint64_t random = 3;
    int mean_held = 0, ratio_held = 0;
    for (int t = 0; t < TRIALS; t++) {
        double x[N], upper[N], lower[N];
        for (int k = 0; k < N; k++) {
            x[k] = 5.0 + random_bell(&random);
            lower[k] = 10.0 + random_bell(&random);
            upper[k] = 0.3 * lower[k] + 0.2 * random_bell(&random);
        }
        const deck_estimate m = deck_mean(N, x), r = deck_ratio(N, upper, lower);
        mean_held += fabs(m.value - 5.0) <= m.interval, ratio_held += fabs(r.value - 0.3) <= r.interval;
    }
    assert_in_range(mean_held, 0.935 * TRIALS, 0.965 * TRIALS);
    assert_in_range(ratio_held, 0.93 * TRIALS, 0.97 * TRIALS);
    const double nothing[N] = {0.0};
    assert_true(isnan(deck_ratio(N, nothing, nothing).value) && isnan(deck_mean(0, nothing).value) &&
                isnan(deck_mean(1, nothing).interval));
}

/* A hold-up that fills like 1 - exp(-t/T) under a steady feed, with scatter: found steady after some T, not before one,
   and never where the hold-up grows on. */
static int first_steady(double filling, double growth, double scatter, double tolerance, uint64_t seed) {
    enum { N = 200, NEED = DECK_STEADY_WINDOWS };
    double in[N], out[N], holdup[N], held = 0.0;
    for (int k = 0; k < N; k++) {
        in[k] = 1.0 + 0.01 * random_bell(&seed);
        out[k] = (1.0 - growth) * (1.0 - exp(-k / filling)) + scatter * random_bell(&seed);
        holdup[k] = held += in[k] - out[k];
    }
    for (int end = NEED; end <= N; end++)
        if (deck_is_steady(NEED, in + end - NEED, out + end - NEED, holdup + end - NEED, tolerance)) return end - NEED;
    return -1;
}
static void test_steady_state(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 50; seed++) {
        const int quick = first_steady(3.0, 0.0, 0.02, 0.05, seed), slow = first_steady(12.0, 0.0, 0.02, 0.05, seed);
        if (!(quick >= 3 && quick < 40)) fail_msg("filling in 3 windows: steady from %d on", quick);
        if (!(slow >= 12 && slow < 120)) fail_msg("filling in 12 windows: steady from %d on", slow);
        /* a tenth of the feed stays on the deck for ever */
        assert_int_equal(first_steady(3.0, 0.10, 0.02, 0.05, seed), -1);
        assert_int_equal(first_steady(3.0, 0.0, 0.5, 0.05, seed), -1);   /* scatter that allows no judgement */
    }
    double in[8] = {1, 1, 1, 1, 1, 1, 1, 1}, out[8] = {1, 1, 1, 1, 1, 1, 1, 1}, holdup[8] = {5, 5, 5, 5, 5, 5, 5, 5};
    assert_true(deck_is_steady(8, in, out, holdup, 0.05));
    assert_false(deck_is_steady(3, in, out, holdup, 0.05));
    assert_false(deck_is_steady(65, in, out, holdup, 0.05));
    assert_false(deck_is_steady(8, in, out, holdup, (double)NAN));
    out[7] = (double)NAN;
    assert_false(deck_is_steady(8, in, out, holdup, 0.05));
    out[7] = 1.0, holdup[2] = (double)INFINITY;
    assert_false(deck_is_steady(8, in, out, holdup, 0.05));
    const double none[8] = {0.0};
    assert_false(deck_is_steady(8, none, none, none, 0.05));
}

/* ---- the machine ---- */

static deck_def small_machine(int decks) {
    deck_def d = deck_default();
    d.decks = decks;
    d.length = 0.25, d.width = 0.06, d.flow = 0.3;
    d.stiffness = 2e4;
    d.longest = 2.0;
    return d;
}

static void test_rounding(void **state) {
    (void)state;
    deck_def d = small_machine(3);
    assert_null(deck_round(&d));
    for (int k = 0; k < 3; k++) {
        const double across = d.width / (d.aperture[k] + d.wire[k]);
        assert_true(fabs(across - floor(across + 0.5)) < 1e-9 && d.wire[k] > 0.0);
    }
    const double along = d.length / (d.aperture[0] + d.wire[0]);
    assert_true(fabs(along - floor(along + 0.5)) < 1e-9 && (int)(along + 0.5) % 2 == 1);
    assert_true(d.width >= 3.0 * deck_largest(&d.sizes));
    const deck_def good = d;
    d = good, d.aperture[1] = 0.011, assert_string_equal(deck_round(&d), "aperture");
    d = good, d.aperture[0] = (double)NAN, assert_string_equal(deck_round(&d), "aperture");
    d = good, d.length = 0.05, assert_string_equal(deck_round(&d), "length");
    d = good, d.length = (double)NAN, assert_string_equal(deck_round(&d), "length");
    d = good, d.width = (double)NAN, assert_string_equal(deck_round(&d), "width");
    d = good, d.width = HUGE_VAL, assert_string_equal(deck_round(&d), "width");
    d = good, d.spacing = 0.01, assert_string_equal(deck_round(&d), "spacing");
    d = good, d.sizes.largest = (double)NAN, assert_non_null(deck_round(&d));
}

/* The deck's way is the ellipse that was asked for; at the top of a circle "with" the flow it runs downhill. */
static void test_motion(void **state) {
    (void)state;
    static const double shape[][3] = {{4e-3, 0.0, 0.8}, {3e-3, 3e-3, 0.0}, {4e-3, 1.5e-3, 1.1}, {4e-3, -1.5e-3, 0.4}};
    for (int k = 0; k < 4; k++) {
        deck_def d = small_machine(1);
        deck_machine m;
        d.amplitude = shape[k][0], d.minor = shape[k][1], d.direction = shape[k][2];
        assert_null(deck_round(&d));
        assert_int_equal(deck_make(&m, &d), DEM_OK);
        const double c = cos(d.direction), s = sin(d.direction), turn = 2.0 * RIDDLE_PI * d.frequency;
        for (int q = 1; q <= 7; q++) {
            assert_int_equal(dem_run(&m.world, 0.009, DEM_LINEAR | DEM_FRICTION), DEM_OK);
            const double t = m.world.time, a = d.amplitude * sin(turn * t), b = d.minor * (cos(turn * t) - 1.0);
            for (int wall = 0; wall <= 1; wall++) { /* the deck and the plate at its upper end */
                const dem_wall *w = &m.world.wall[wall];
                assert_true(fabs(w->position.x - w->asked.origin.x - (a * c - b * s)) < 1e-9);
                assert_true(fabs(w->position.z - w->asked.origin.z - (a * s + b * c)) < 1e-9);
            }
        }
        deck_free(&m);
    }
    deck_def d = small_machine(1);
    d.amplitude = d.minor = 4e-3, d.inclination = 0.0;
    assert_true(fabs(deck_toss(&d) - 4e-3 * pow(2.0 * RIDDLE_PI * 16.0, 2.0) / 9.81) < 1e-12);
}

static void run_machine(deck_machine *m, deck_books *b, const deck_def *d, double time) {
    assert_int_equal(deck_make(m, d), DEM_OK);
    deck_books_open(b, d, 0.1);
    while (m->world.time < time - 1e-9) {
        assert_int_equal(deck_advance(m), DEM_OK);
        assert_int_equal(deck_look(b, m), 0);
    }
}

/* Every grain that was fed is in the machine or in one product, by number, class and mass; events tell the same as
   the products. */
static void check_books(const deck_machine *m, const deck_books *b) {
    ptrdiff_t present[DECK_CLASSES] = {0}, all = 0, noted[DECKS_MAX + 1] = {0};
    double mass = 0.0, fed = 0.0;
    for (ptrdiff_t i = 0; i < m->world.count; i++) {
        if (!m->world.alive[i]) continue;
        const deck_grain *g = &b->grain[m->world.id[i]];
        assert_false(g->left);
        present[g->klass]++;
        mass += g->mass;
    }
    for (ptrdiff_t e = 0; e < b->events; e++)
        if (b->event[e].left) noted[b->event[e].level]++, mass += b->event[e].mass;
    for (int c = 0; c < b->classes.count; c++) {
        ptrdiff_t products = 0;
        for (int k = 0; k <= m->def.decks; k++) products += b->left[k][c], noted[k] -= b->left[k][c];
        assert_int_equal(b->fed[c], present[c] + products);
        all += b->fed[c];
    }
    for (int k = 0; k <= m->def.decks; k++) assert_int_equal(noted[k], 0);
    for (ptrdiff_t w = 0; w < b->windows; w++) fed += b->window[w].fed;
    assert_int_equal(all, m->feed.placed);
    assert_true(all > 100);
    assert_true(fabs(mass / m->feed.placed_mass - 1.0) < 1e-12 && fabs(fed / m->feed.placed_mass - 1.0) < 1e-12);
}

static void test_balance(void **state) {
    (void)state;
    for (int decks = 1; decks <= DECKS_MAX; decks++)
        for (int mesh = DECK_SQUARE; mesh <= (decks == 1 ? DECK_SLOTS_ACROSS : DECK_SQUARE); mesh++) {
            deck_def d = small_machine(decks);
            deck_machine m;
            deck_books b;
            d.mesh = mesh, d.slot_length = 0.03;
            assert_null(deck_round(&d));
            run_machine(&m, &b, &d, mesh == DECK_SQUARE ? 1.0 : 0.6);
            check_books(&m, &b);
            deck_answer a;
            for (int k = 0; k < decks; k++) {
                deck_measure(&b, &d, k, 3, (int)b.windows, &a);
                double over = 0.0, arrived = 0.0, before[DECK_CLASSES];
                for (int c = 0; c < b.classes.count; c++) {
                    arrived += a.arrived[c];
                    if (a.arrived[c] > 0.0) over += a.arrived[c] * a.partition[c].value;
                    before[c] = 1.0;
                    for (int s = 0; s < DECK_STATIONS && a.arrived[c] > 0.0; s++) {
                        assert_true(a.retained[c][s] <= before[c] && a.retained[c][s] >= -1e-12);
                        before[c] = a.retained[c][s];
                    }
                    if (a.arrived[c] > 0.0) assert_true(fabs(before[c] - a.partition[c].value) < 1e-9);
                }
                assert_true(fabs(over - a.over.value * a.duration) < 1e-9);
                assert_true(fabs(arrived - (a.over.value + a.under.value) * a.duration) < 1e-9);
            }
            deck_books_free(&b);
            deck_free(&m);
        }
}

/* Moist: the liquid that was fed is in films and bridges, to the last bit; grains as above. */
static void test_balance_of_liquid(void **state) {
    (void)state;
    for (int decks = 1; decks <= 2; decks++) {
        deck_def d = small_machine(decks);
        deck_machine m;
        deck_books b;
        int bridges;
        d.moisture = 0.03;
        assert_null(deck_round(&d));
        run_machine(&m, &b, &d, 0.5);
        check_books(&m, &b);
        assert_true(wet_total(m.wet, &m.world, &bridges) == m.liquid);
        assert_true(bridges > 20);
        /* about what was asked for: films are by surface, and the grains are some hundreds */
        assert_true(fabs(m.liquid * 1000.0 / m.feed.placed_mass / d.moisture - 1.0) < 0.15);
        deck_books_free(&b);
        deck_free(&m);
    }
}

/* Square holes, slots along and across: grains laid over them pass if they are narrower, and stay if they are wider. */
static void test_holes(void **state) {
    (void)state;
    for (int mesh = DECK_SQUARE; mesh <= DECK_SLOTS_ACROSS; mesh++) {
        deck_def d = small_machine(1);
        deck_machine m;
        d.mesh = mesh, d.slot_length = 0.03, d.inclination = 0.0, d.amplitude = 0.0, d.flow = 1e-9;
        assert_null(deck_round(&d));
        assert_int_equal(deck_make(&m, &d), DEM_OK);
        const double pitch = 0.0125, hole = mesh == DECK_SLOTS_ACROSS
                                                ? 8.5 * pitch
                                                : 0.5 * (0.03 + 0.0025) + (mesh == DECK_SQUARE ? 0.0 : 0.0325);
        const double x = mesh == DECK_SQUARE ? 8.5 * pitch : hole;
        const double y = mesh == DECK_SQUARE        ? 2.5 * pitch
                         : mesh == DECK_SLOTS_ALONG ? -3.0 * d.width + 15.5 * pitch
                                                    : 0.0;
        double at[3] = {x, y, 0.02}, size = 0.0095;
        const double slot = mesh == DECK_SLOTS_ACROSS ? -3.0 * d.width + 6.5 * 0.0325 : y;
        at[1] = slot;
        assert_int_equal(dem_add_spheres(&m.world, 1, at, &size, 0, 0), DEM_OK);
        at[mesh == DECK_SLOTS_ALONG ? 0 : 0] += mesh == DECK_SLOTS_ALONG ? 0.0325 : 2.0 * pitch, size = 0.0108;
        assert_int_equal(dem_add_spheres(&m.world, 1, at, &size, 0, 0), DEM_OK);
        for (int q = 0; q < 40; q++) assert_int_equal(deck_advance(&m), DEM_OK);
        assert_int_equal(m.world.passed_count, 1);
        assert_int_equal(m.world.passed[0].id, 0);
        deck_free(&m);
    }
}

/* What is read of a run does not depend on the number of threads. */
static void test_threads(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        deck_def d = small_machine(2);
        deck_machine m;
        deck_books b;
        d.threads = 1 + 2 * k;
        assert_null(deck_round(&d));
        run_machine(&m, &b, &d, 0.3);
        hash[k] = dem_hash(&m.world);
        deck_books_free(&b);
        deck_free(&m);
    }
    assert_true(hash[0] == hash[1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_student),      cmocka_unit_test(test_intervals_cover),
        cmocka_unit_test(test_steady_state), cmocka_unit_test(test_rounding),
        cmocka_unit_test(test_motion),       cmocka_unit_test(test_balance),
        cmocka_unit_test(test_holes),        cmocka_unit_test(test_balance_of_liquid),
        cmocka_unit_test(test_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
