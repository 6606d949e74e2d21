/* dem.h: near pairs of any size, sizes drawn from distributions, filling, feeding and removing. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include "near.h"

#include <stdio.h>
#include <stdlib.h>

#include "common.h"
#include "dem_scenes.h"
#include "failing_allocator.h"

static const double nan_ = (double)NAN, inf = (double)INFINITY;

static dem_vec v3(double x, double y, double z) { return dem_vec3(x, y, z); }

static dem_def plain_def(const dem_allocator *allocator) {
    dem_def def = dem_default_def();
    dem_add_material(&def, 2500.0, 1e7, 0.2);
    dem_pair(&def, 0, 0)->stiffness = 1e3; /* 1 mm spheres: contacts of 22 steps */
    def.dt = 1e-5;
    if (allocator) def.allocator = *allocator;
    return def;
}
static dem_world plain_world(void) {
    dem_world w;
    dem_def def = plain_def(NULL);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    return w;
}

/* ---- near pairs ---- */

static double closest_gap(const dem_world *w, ptrdiff_t i, ptrdiff_t j) {
    double square = 0.0;
    const dem_vec a = dem_position(w, i), b = dem_position(w, j);
    for (int k = 0; k < 3; k++) {
        const double length = dem_axis(w->def.high, k) - dem_axis(w->def.low, k);
        double d = dem_axis(a, k) - dem_axis(b, k);
        if (w->def.periodic[k]) d -= length * floor(d / length + 0.5);
        square += d * d;
    }
    return sqrt(square) - dem_radius(w, i) - dem_radius(w, j);
}

/* The list of the header against all pairs: none missing, none twice, none that is far. */
static void list_equals_brute_force(dem_world *w, const char *what) {
    assert_int_equal(dem_run(w, 0.0, DEM_LINEAR), DEM_OK);
    const ptrdiff_t n = w->count;
    unsigned char *listed = calloc((size_t)(n * n), 1);
    assert_non_null(listed);
    for (ptrdiff_t p = 0; p < w->engine->pairs.count; p++) {
        const dem__near *q = &w->engine->pairs.near[p];
        unsigned char *at = &listed[q->i * n + q->j];
        assert_true(q->i < q->j);
        if (*at) fail_msg("%s: pair %d %d stands twice", what, q->i, q->j);
        *at = 1;
    }
    ptrdiff_t near_pairs = 0;
    for (ptrdiff_t i = 0; i < n; i++) {
        for (ptrdiff_t j = i + 1; j < n; j++) {
            const double gap = closest_gap(w, i, j) - w->engine->pairs.skin;
            near_pairs += gap < 0.0;
            if (fabs(gap) > 1e-12 && (gap < 0.0) != listed[i * n + j])
                fail_msg("%s: pair %d %d, %g over the skin, is %s", what, (int)i, (int)j, gap,
                         gap < 0.0 ? "missing" : "listed");
        }
    }
    assert_true(near_pairs > 0);
    free(listed);
}

static void test_near_pairs_of_any_size(void **state) {
    (void)state;
    static const double ratios[] = {1.0, 1.5, 3.0, 20.0, 1000.0, 3e7};
    scene_random r = {11};
    for (int k = 0; k < 6 * 8; k++) {
        const double ratio = ratios[k / 8];
        const int periodic = k % 8, stray = k % 8 == 0 || k % 8 == 5;
        dem_def def = plain_def(NULL);
        dem_world w;
        char what[80];
        for (int a = 0; a < 3; a++) def.periodic[a] = periodic >> a & 1;
        def.low = v3(-0.03, 0.01, -1.0);
        def.high = v3(k % 3 ? 0.03 : 0.053, 0.05, -0.95);
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        for (int i = 0; i < 600; i++) {
            const double d = 0.008 * riddle_exp(-riddle_log(ratio) * scene_uniform(&r));
            dem_vec x = def.low;
            for (int a = 0; a < 3; a++)
                *dem_axis_of(&x, a) += (dem_axis(def.high, a) - dem_axis(def.low, a)) * scene_uniform(&r);
            if (i == 0) x = def.high; /* the corner belongs to the other side */
            if (stray && i == 7) x = v3(1e6, -3e7, 1e12);
            assert_int_equal(dem_add_spheres(&w, 1, &x.x, &d, 0, 0), DEM_OK);
        }
        snprintf(what, sizeof what, "1 : %g, periodic %d", ratio, periodic);
        list_equals_brute_force(&w, what);
        dem_free(&w);
    }
}

/* Hundreds in one place besides one far away: cells stay small enough (the list would take seconds if one held all). */
static void test_strays_do_not_spoil_the_cells(void **state) {
    (void)state;
    scene_random r = {3};
    dem_world w = plain_world();
    for (int i = 0; i < 30000; i++) {
        const double d = 1e-3, far = i % 10000 == 0 ? 1e9 : 1.0;
        const dem_vec x = v3(0.05 * scene_uniform(&r), 0.05 * scene_uniform(&r), far * 0.05 * scene_uniform(&r));
        assert_int_equal(dem_add_spheres(&w, 1, &x.x, &d, 0, 0), DEM_OK);
    }
    assert_int_equal(dem_run(&w, 0.0, DEM_LINEAR), DEM_OK);
    const double reach = (1.0 + w.def.skin) * 1e-3, expected = 0.5 * 30000.0 * 30000.0 * 4.0 / 3.0 * RIDDLE_PI * reach *
                                                               reach * reach / (0.05 * 0.05 * 0.05);
    near_relative((double)w.engine->pairs.count, expected, 0.1, "near pairs of random points");
    dem_free(&w);
}

/* ---- sizes ---- */

typedef struct moments {
    double mean, mean_log, deviation_log, least, most;
} moments;

static moments draw_many(const dem_sizes *s, int n) {
    moments m = {0.0, 0.0, 0.0, inf, 0.0};
    uint64_t random = 5;
    for (int k = 0; k < n; k++) {
        const double d = dem_draw_size(s, &random);
        if (!(d > 0.0)) fail_msg("drew %g", d);
        m.mean += d / n;
        m.mean_log += log(d) / n;
        m.deviation_log += log(d) * log(d) / n;
        m.least = d < m.least ? d : m.least;
        m.most = d > m.most ? d : m.most;
    }
    m.deviation_log = sqrt(m.deviation_log - m.mean_log * m.mean_log);
    return m;
}

/* Largest distance between the drawn distribution by number and its integral, found by Simpson's rule from the
   density by mass. */
static double distance_to(const dem_sizes *s, double (*density)(const dem_sizes *s, double d), int n) {
    enum { BINS = 400 };
    double whole = 0.0, so_far = 0.0, count[BINS] = {0.0}, part[BINS], worst = 0.0;
    const double low = log(s->smallest), width = (log(s->largest) - low) / BINS;
    uint64_t random = 99;
    for (int k = 0; k < n; k++) {
        const double d = dem_draw_size(s, &random);
        assert_true(d >= s->smallest && d <= s->largest);
        const int bin = (int)((log(d) - low) / width);
        count[bin < BINS ? bin : BINS - 1] += 1.0 / n;
    }
    for (int b = 0; b < BINS; b++) {
        part[b] = 0.0;
        for (int q = 0; q <= 8; q++) {
            const double d = exp(low + (b + q / 8.0) * width), weight = q == 0 || q == 8 ? 1.0 : (q % 2 ? 4.0 : 2.0);
            part[b] += weight * density(s, d) * d / (s->by_mass ? d * d * d : 1.0);
        }
        whole += part[b];
    }
    double drawn = 0.0;
    for (int b = 0; b < BINS; b++) {
        so_far += part[b] / whole, drawn += count[b];
        worst = fmax(worst, fabs(so_far - drawn));
    }
    return worst;
}
static double flat(const dem_sizes *s, double d) { return (void)s, (void)d, 1.0; }
static double lognormal(const dem_sizes *s, double d) {
    const double u = log(d / s->scale) / s->spread;
    return exp(-0.5 * u * u) / d;
}
static double rosin_rammler(const dem_sizes *s, double d) {
    return pow(d / s->scale, s->spread - 1.0) * exp(-pow(d / s->scale, s->spread));
}

static void test_sizes(void **state) {
    (void)state;
    const int n = 100000;
    const double kolmogorov = 1.95 / sqrt(n); /* exceeded once in a thousand */
    for (int by_mass = 0; by_mass < 2; by_mass++) {
        const dem_sizes uniform = dem_uniform_sizes(1e-3, 20e-3, by_mass),
                        narrow = dem_uniform_sizes(1e-3, 1e-3, by_mass);
        assert_true(distance_to(&uniform, flat, n) < kolmogorov);
        assert_true(draw_many(&narrow, 10).most == 1e-3);
        static const double spread[] = {0.02, 0.4, 1.5}, exponent[] = {0.7, 1.2, 3.0, 12.0};
        for (int k = 0; k < 3; k++) {
            const dem_sizes s = dem_lognormal_sizes(2e-3, spread[k], 0.4e-3, 9e-3, by_mass);
            assert_true(distance_to(&s, lognormal, n) < kolmogorov);
        }
        for (int k = 0; k < 4; k++) {
            const dem_sizes s = dem_rosin_rammler_sizes(2e-3, exponent[k], 0.3e-3, 8e-3, by_mass);
            assert_true(distance_to(&s, rosin_rammler, n) < kolmogorov);
        }
    }
    /* Hatch & Choate 1929: lognormal by mass with median D is lognormal by number with median D exp(-3 s^2)
       and the same s */
    const dem_sizes wide = dem_lognormal_sizes(1e-3, 0.3, 1e-5, 1e-1, 1);
    const moments m = draw_many(&wide, n);
    near_absolute(m.mean_log, log(1e-3) - 0.27, 4.0 * 0.3 / sqrt(n), "mean of ln d");
    near_relative(m.deviation_log, 0.3, 0.01, "deviation of ln d");

    /* a third of the mass each, as in the batch screen */
    const double d[3] = {5e-3, 7e-3, 10e-3}, share[3] = {2.0, 2.0, 2.0}, none[3] = {1.0, 0.0, 0.0};
    const dem_sizes thirds = dem_size_list(3, d, share, 1), first = dem_size_list(3, d, none, 1);
    double mass[3] = {0.0, 0.0, 0.0};
    uint64_t random = 8;
    for (int k = 0; k < n; k++) {
        const double drawn = dem_draw_size(&thirds, &random);
        const int c = drawn == d[0] ? 0 : (drawn == d[1] ? 1 : 2);
        assert_true(drawn == d[c] && dem_draw_size(&first, &random) == d[0]);
        mass[c] += drawn * drawn * drawn;
    }
    for (int c = 0; c < 3; c++)
        near_relative(mass[c] / (mass[0] + mass[1] + mass[2]), 1.0 / 3.0, 0.02, "share of mass");
}

static void test_bad_sizes(void **state) {
    (void)state;
    uint64_t random = 1;
    const double d[2] = {1e-3, 2e-3}, negative[2] = {1.0, -1.0}, zero[2] = {0.0, 0.0}, share[2] = {1.0, 1.0},
                 many[40] = {1.0}, bad[2] = {1e-3, nan_}, tiny[2] = {1e-300, 1.0};
    const dem_sizes wrong[] = {
        dem_size_list(0, d, share, 0),
        dem_size_list(33, many, many, 0),
        dem_size_list(2, d, negative, 0),
        dem_size_list(2, d, zero, 0),
        dem_size_list(2, bad, share, 0),
        dem_size_list(2, d, bad, 0),
        dem_size_list(2, tiny, share, 0),
        dem_size_list(2, NULL, share, 0),
        dem_uniform_sizes(0.0, 1.0, 0),
        dem_uniform_sizes(2.0, 1.0, 0),
        dem_uniform_sizes(1e-9, 1.0, 0),
        dem_uniform_sizes(1.0, inf, 0),
        dem_uniform_sizes(nan_, 1.0, 0),
        dem_lognormal_sizes(1e-3, 0.0, 1e-4, 1e-2, 0),
        dem_lognormal_sizes(1e-3, nan_, 1e-4, 1e-2, 0),
        dem_lognormal_sizes(-1.0, 0.1, 1e-4, 1e-2, 0),
        dem_rosin_rammler_sizes(1e-3, 0.0, 1e-4, 1e-2, 1),
        dem_rosin_rammler_sizes(inf, 1.0, 1e-4, 1e-2, 1),
    };
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        if (!isnan(dem_draw_size(&wrong[k], &random))) fail_msg("bad sizes %d were taken", (int)k);
    }
    const dem_sizes fine = dem_one_size(1e-3), tight = dem_rosin_rammler_sizes(1e-300, 100.0, 1e-300, 1e-294, 1);
    assert_true(isnan(dem_draw_size(&fine, NULL)) && isnan(dem_draw_size(NULL, &random)));
    assert_true(dem_draw_size(&tight, &random) > 0.0);
}

/* ---- filling ---- */

static void nothing_overlaps(dem_world *w) {
    assert_int_equal(dem_run(w, 0.0, DEM_LINEAR), DEM_OK);
    assert_int_equal(dem_contact_count(w), 0);
    for (ptrdiff_t p = 0; p < w->engine->pairs.count; p++)
        assert_true(closest_gap(w, w->engine->pairs.near[p].i, w->engine->pairs.near[p].j) >= -1e-15);
}

static void whole_within(const dem_world *w, const dem_region *region) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_vec x = dem_position(w, i);
        for (int k = 0; k < 26; k++) {
            const dem_vec way = v3(k % 3 - 1.0, k / 3 % 3 - 1.0, k / 9 - 1.0);
            const double length = sqrt(way.x * way.x + way.y * way.y + way.z * way.z),
                         r = dem_radius(w, i) * (1.0 - 1e-9);
            if (length > 0.0)
                assert_true(dem_region_holds(
                    region, v3(x.x + r * way.x / length, x.y + r * way.y / length, x.z + r * way.z / length)));
        }
    }
}

static void test_fill(void **state) {
    (void)state;
    const dem_region regions[] = {dem_box_region(v3(-0.02, 0.0, 0.01), v3(0.02, 0.03, 0.06)),
                                  dem_cylinder_region(v3(0.01, 0, 0), v3(1, 2, 3), 0.05, 0.02),
                                  dem_sphere_region(v3(0, 0, -1), 0.025)};
    const dem_sizes sizes[] = {dem_one_size(3e-3), dem_lognormal_sizes(2e-3, 0.5, 0.6e-3, 8e-3, 0),
                               dem_uniform_sizes(0.5e-3, 10e-3, 1)};
    for (int k = 0; k < 9; k++) {
        dem_world w = plain_world();
        dem_feed feed = dem_default_feed();
        double mass = 0.0, largest = 0.0;
        feed.region = regions[k / 3];
        feed.sizes = sizes[k % 3];
        feed.group = 4;
        feed.velocity = v3(0.1, 0, -2.0);
        feed.scatter = v3(0, 0.5, 0.25);
        const double wanted = 0.2 * dem_region_volume(&feed.region) * 2500.0;
        assert_int_equal(dem_fill_mass(&w, &feed, wanted), DEM_OK);
        for (ptrdiff_t i = 0; i < w.count; i++) {
            const dem_vec v = dem_velocity(&w, i);
            mass += dem_mass(&w, i);
            assert_true(w.group[i] == 4 && v.x == 0.1 && fabs(v.y) <= 0.5 && fabs(v.z + 2.0) <= 0.25);
            largest = fmax(largest, dem_mass(&w, i));
        }
        assert_int_equal(feed.placed, w.count);
        near_relative(feed.placed_mass, mass, 1e-12, "placed mass");
        near_absolute(feed.placed_mass + feed.missed_mass, wanted, 0.5 * largest * 1.001, "wanted mass");
        assert_true(feed.missed_mass < 0.02 * wanted && w.count > 50);
        whole_within(&w, &feed.region);
        nothing_overlaps(&w);
        dem_free(&w);
    }
}

/* Into what is there already, past walls of every kind, in periodic directions, in bits of the same seed. */
static void test_fill_among_others(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int again = 0; again < 2; again++) {
        dem_world w;
        dem_def def = plain_def(NULL);
        def.periodic[0] = 1;
        def.low = v3(0, 0, 0), def.high = v3(0.1, 1, 1);
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        dem_screen screen = dem_default_screen();
        screen.centre = v3(0.05, 0.05, 0.05), screen.half_x = 0.03;
        assert_true(dem_add_screen(&w, 0, &screen) >= 0 && dem_add_plane(&w, 0, v3(0, 0.02, 0), v3(0, 1, 0.2)) >= 0);
        assert_true(dem_add_cylinder(&w, 0, v3(0.02, 0, 0.08), v3(0, 1, 0), 0.006, 0) >= 0);
        assert_true(dem_add_exit(&w, v3(0, 0, 0.01), v3(0, 0, 1)) >= 0);
        const int ignored = dem_add_plane(&w, 0, v3(0, 0.06, 0), v3(0, 1, 0));
        assert_int_equal(dem_enable_wall(&w, ignored, 0), DEM_OK);
        const double big = 0.03;
        const dem_vec at = v3(0.095, 0.07, 0.07);
        assert_int_equal(dem_add_spheres(&w, 1, &at.x, &big, 0, 0), DEM_OK);
        dem_feed feed = dem_default_feed();
        feed.sizes = dem_uniform_sizes(1e-3, 6e-3, 1);
        feed.random = 77;
        for (int k = 0; k < 5; k++) assert_int_equal(dem_fill(&w, &feed, 400), DEM_OK);
        assert_int_equal(feed.placed + feed.missed, 2000);
        assert_true(feed.placed > 1800);
        int below = 0, reach = 0;
        for (ptrdiff_t i = 1; i < w.count; i++) {
            const dem_vec x = dem_position(&w, i);
            assert_true(x.z >= 0.01);
            below += x.y < 0.05, reach += x.x < 0.02;
        }
        assert_true(below > 200 && reach > 100);
        nothing_overlaps(&w);
        hash[again] = dem_hash(&w);
        dem_free(&w);
    }
    assert_true(hash[0] == hash[1]);
}

static void test_fill_tells_what_it_missed(void **state) {
    (void)state;
    dem_world w = plain_world();
    dem_feed feed = dem_default_feed();
    feed.region = dem_box_region(v3(0, 0, 0), v3(0.01, 0.01, 0.01));
    feed.tries = 200;
    assert_int_equal(dem_fill(&w, &feed, 3000), DEM_OK); /* solid share 1.57 */
    const double share = (double)feed.placed * RIDDLE_PI / 6.0 * 1e-9 / 1e-6;
    assert_true(share > 0.2 && share < 0.385); /* random sequential addition jams at 0.384 of the whole space */
    assert_int_equal(feed.placed + feed.missed, 3000);
    near_relative(feed.missed_mass, (double)feed.missed * RIDDLE_PI / 6.0 * 1e-9 * 2500.0, 1e-12, "missed mass");
    const ptrdiff_t before = w.count;
    feed.sizes = dem_one_size(0.011); /* larger than the region */
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_OK);
    assert_true(w.count == before && feed.missed == 3000 - before + 1);
    dem_free(&w);
}

/* ---- feeding ---- */

static void test_feed_in_time(void **state) {
    (void)state;
    for (int by_mass = 0; by_mass < 2; by_mass++) {
        dem_world w = plain_world();
        dem_feed feed = dem_default_feed();
        feed.region = dem_cylinder_region(v3(0, 0, 0.5), v3(0, 0, 1), 0.0, 0.03); /* a disc */
        feed.sizes = dem_lognormal_sizes(2e-3, 0.3, 1e-3, 4e-3, 1);
        feed.velocity = v3(0, 0, -1.0);
        assert_true(dem_add_exit(&w, v3(0, 0, 0.4), v3(0, 0, 1)) >= 0);
        const double rate = 12345.6, mass_flow = 0.123, step = 0.005;
        double gone = 0.0;
        for (int k = 0; k < 25; k++) {
            const ptrdiff_t before = w.count;
            assert_int_equal(
                by_mass ? dem_feed_mass(&w, &feed, mass_flow, step) : dem_feed_number(&w, &feed, rate, step), DEM_OK);
            for (ptrdiff_t i = before; i < w.count; i++) {
                const dem_vec x = dem_position(&w, i);
                assert_true(x.z == 0.5 && sqrt(x.x * x.x + x.y * x.y) <= 0.03 - dem_radius(&w, i) + 1e-12);
            }
            assert_int_equal(dem_run(&w, step, DEM_LINEAR), DEM_OK);
        }
        for (ptrdiff_t k = 0; k < w.passed_count; k++)
            gone += RIDDLE_PI / 6.0 * pow(w.passed[k].diameter, 3.0) * 2500.0;
        double here = 0.0;
        ptrdiff_t present = 0;
        for (ptrdiff_t i = 0; i < w.count; i++) here += w.alive[i] ? dem_mass(&w, i) : 0.0, present += w.alive[i];
        near_relative(here + gone, feed.placed_mass, 1e-12, "mass placed, present and passed");
        assert_int_equal(present + w.passed_count, feed.placed);
        assert_true(w.passed_count > 0);
        if (by_mass)
            near_absolute(feed.placed_mass, mass_flow * 25 * step, 0.5 * 2500.0 * RIDDLE_PI / 6.0 * 64e-9, "mass flow");
        else assert_int_equal(feed.placed, 1543);
        dem_free(&w);
    }
}

/* What cannot be placed stays due, and the sizes keep their shares: the large ones are not passed over. */
/* A source owes half a sphere at most, or is ahead by that much; a hundred short times place what one long one does. */
static void test_feed_owes_half_a_sphere(void **state) {
    (void)state;
    dem_world w = plain_world();
    dem_feed feed = dem_default_feed();
    double wanted = 0.0;
    feed.sizes = dem_one_size(1e-3);
    for (int k = 0; k < 100; k++) {
        assert_int_equal(dem_feed_number(&w, &feed, 37.3, 0.01), DEM_OK);
        wanted += 0.373;
        assert_true(fabs((double)feed.placed - wanted) <= 0.5 + 1e-9 &&
                    fabs(feed.due - (wanted - (double)feed.placed)) < 1e-9);
    }
    assert_int_equal(feed.placed, 37);
    feed.placed = PTRDIFF_MAX; /* a count that can't grow is refused */
    assert_int_equal(dem_feed_number(&w, &feed, 1e3, 0.01), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT);
    feed.placed = 0, feed.missed = -1;
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT);
    dem_free(&w);
}

/* A distribution cut off far from its bulk: refused where the cuts leave nothing of it; else drawn in a bounded number
   of tries (the generator's state tells them), and as it is within the cuts. */
static void test_sizes_cut_far_out(void **state) {
    (void)state;
    const dem_sizes none[] = {
        dem_rosin_rammler_sizes(2e-5, 4.0, 1e-3, 4e-3, 1), dem_rosin_rammler_sizes(2e-4, 10.0, 1e-3, 4e-3, 1),
        dem_rosin_rammler_sizes(2.0, 20.0, 1e-3, 4e-3, 1), dem_lognormal_sizes(1.0, 0.3, 1e-3, 4e-3, 0),
        dem_lognormal_sizes(1e-6, 0.3, 1e-3, 4e-3, 1),     dem_rosin_rammler_sizes(1e-9, 100.0, 1e-3, 4e-3, 0)};
    uint64_t random = 5;
    for (size_t k = 0; k < sizeof none / sizeof *none; k++) {
        dem_world w = plain_world();
        dem_feed feed = dem_default_feed();
        const double d = dem_draw_size(&none[k], &random);
        assert_true(d != d);
        feed.sizes = none[k];
        assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT);
        dem_free(&w);
    }
    /* the tail of an exponential is one again: its mean lies a scale past the cut */
    const dem_sizes tails[] = {
        dem_rosin_rammler_sizes(1e-3, 1.0, 3e-2, 1e3, 0), dem_rosin_rammler_sizes(1e-3, 8.0, 1.4e-3, 1.0, 0),
        dem_lognormal_sizes(1e-3, 1e-3, 1.005e-3, 9e2, 0), dem_lognormal_sizes(1e-3, 1e-3, 1e-6, 0.9, 1),
        dem_lognormal_sizes(1e-3, 5.0, 1e-6, 0.9, 1)};
    for (size_t k = 0; k < sizeof tails / sizeof *tails; k++) {
        const int n = 20000;
        double mean = 0.0;
        random = 0;
        for (int q = 0; q < n; q++) {
            const double d = dem_draw_size(&tails[k], &random);
            assert_true(d >= tails[k].smallest && d <= tails[k].largest);
            mean += d / n;
        }
        uint64_t tries = 0; /* each takes three numbers */
        for (uint64_t at = 0; at != random && tries < 100u * (uint64_t)n; tries++) at += 3u * 0x9e3779b97f4a7c15u;
        assert_true(tries < 12u * (uint64_t)n);
        if (k == 0) near_relative(mean, 3.1e-2, 1e-3, "mean beyond the cut"); /* exp(-d/scale): memoryless */
        if (k == 3) near_relative(mean, 1e-3, 1e-4, "mean of a narrow distribution between wide cuts");
    }
}

static void test_feed_waits(void **state) {
    (void)state;
    dem_world w;
    dem_def def = plain_def(NULL);
    def.gravity = v3(0, 0, 0);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    dem_feed feed = dem_default_feed();
    const double d[2] = {2e-3, 8e-3}, share[2] = {0.5, 0.5};
    feed.region = dem_box_region(v3(0, 0, 0), v3(0.02, 0.02, 0.0)); /* a face */
    feed.sizes = dem_size_list(2, d, share, 0);
    feed.velocity = v3(0, 0, 4.0);
    assert_int_equal(dem_feed_number(&w, &feed, 1e5, 1e-3), DEM_OK);
    assert_true(feed.placed < 20 && feed.due > 79.0 && feed.waiting > 0.0);
    near_absolute((double)feed.placed + feed.due, 100.0, 1e-9, "placed and due");
    const ptrdiff_t first = feed.placed;
    assert_int_equal(dem_feed_number(&w, &feed, 0.0, 1.0), DEM_OK); /* no place yet for the large one that waits */
    assert_true(feed.placed == first && feed.waiting == 8e-3);
    for (int k = 0; k < 200; k++) {
        assert_int_equal(dem_run(&w, 2e-3, DEM_LINEAR), DEM_OK);
        assert_int_equal(dem_feed_number(&w, &feed, 1e3, 2e-3), DEM_OK);
    }
    near_absolute((double)feed.placed + feed.due, 500.0, 1e-9, "placed and due");
    assert_true(feed.due < 2.0);
    int large = 0;
    for (ptrdiff_t i = 0; i < w.count; i++) large += dem_radius(&w, i) > 3e-3;
    near_absolute(large / 499.0, 0.5, 0.09, "share of large ones");
    dem_free(&w);
}

/* A copy of the source beside the saved world: the restart goes on with the same bits. */
static void test_feed_restarts(void **state) {
    (void)state;
    dem_world w = plain_world(), copy;
    dem_feed feed = dem_default_feed(), kept;
    assert_true(dem_add_plane(&w, 0, v3(0, 0, 0), v3(0, 0, 1)) >= 0);
    feed.region = dem_box_region(v3(0, 0, 0.01), v3(0.01, 0.01, 0.02));
    feed.sizes = dem_rosin_rammler_sizes(1.5e-3, 3.0, 0.7e-3, 3e-3, 1);
    unsigned char *bytes = NULL;
    size_t size = 0;
    for (int k = 0; k < 40; k++) {
        if (k == 20) {
            size = dem_save(&w, NULL, 0);
            bytes = malloc(size);
            assert_true(bytes && dem_save(&w, bytes, size) == size);
            kept = feed;
        }
        assert_int_equal(dem_feed_mass(&w, &feed, 0.002, 0.002), DEM_OK);
        assert_int_equal(dem_run(&w, 0.002, DEM_LINEAR | DEM_FRICTION), DEM_OK);
    }
    assert_int_equal(dem_load(&copy, bytes, size, NULL), DEM_OK);
    for (int k = 20; k < 40; k++) {
        assert_int_equal(dem_feed_mass(&copy, &kept, 0.002, 0.002), DEM_OK);
        assert_int_equal(dem_run(&copy, 0.002, DEM_LINEAR | DEM_FRICTION), DEM_OK);
    }
    assert_true(w.count > 20 && dem_hash(&w) == dem_hash(&copy));
    assert_memory_equal(&feed, &kept, sizeof feed);
    free(bytes);
    dem_free(&w);
    dem_free(&copy);
}

/* ---- removing ---- */

static void test_remove_and_ledger(void **state) {
    (void)state;
    dem_world w = plain_world();
    dem_feed feed = dem_default_feed();
    assert_true(dem_add_plane(&w, 0, v3(0, 0, 0), v3(0, 0, 1)) >= 0);
    assert_true(dem_add_cylinder(&w, 0, v3(0, 0, 0), v3(0, 0, 1), 0.012, 1) >= 0);
    feed.region = dem_cylinder_region(v3(0, 0, 0.03), v3(0, 0, 1), 0.01, 0.012);
    feed.sizes = dem_one_size(2e-3);
    ptrdiff_t removed = 0, present = 0;
    for (int k = 0; k < 120; k++) {
        const dem_region top = dem_box_region(v3(-1, -1, 0.004), v3(1, 1, 0.01)),
                         drop = dem_sphere_region(v3(0.004, 0, 0.002), 0.004);
        assert_int_equal(dem_feed_number(&w, &feed, 20000.0, 0.001), DEM_OK);
        assert_int_equal(dem_run(&w, 0.001, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY), DEM_OK);
        if (k % 10 == 9) {
            const ptrdiff_t before = w.count - w.engine->bodies.dropped,
                            n = dem_remove_region(&w, k % 20 == 9 ? &top : &drop);
            assert_true(n >= 0 && before - n == w.count - w.engine->bodies.dropped);
            removed += n;
        }
    }
    for (ptrdiff_t i = 0; i < w.count; i++) present += w.alive[i];
    assert_true(removed > 100 && present > 100);
    assert_int_equal(present + removed, feed.placed);
    const dem_energy_ledger e = dem_energy(&w);
    assert_true(e.added > 0.0 && e.removed > 0.0);
    near_absolute(e.error, 0.0, 2e-3 * e.added, "ledger");
    const dem_region all = dem_sphere_region(v3(0, 0, 0), 10.0);
    assert_int_equal(dem_remove_region(&w, &all), present);
    assert_int_equal(dem_contact_count(&w), 0);
    assert_int_equal(dem_run(&w, 0.001, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY), DEM_OK);
    const dem_energy_ledger end = dem_energy(&w);
    assert_true(end.kinetic == 0.0 && end.potential == 0.0 && w.count == 0);
    near_absolute(end.error, 0.0, 2e-3 * end.added, "ledger of an empty world");
    dem_free(&w);
}

/* ---- regions ---- */

static void test_regions(void **state) {
    (void)state;
    const dem_region box = dem_box_region(v3(-1, 0, 2), v3(1, 3, 2.5)),
                     cylinder = dem_cylinder_region(v3(0, 0, 1), v3(0, -2, 0), 3.0, 0.5),
                     ball = dem_sphere_region(v3(1, 1, 1), 2.0);
    near_relative(dem_region_volume(&box), 3.0, 1e-15, "box");
    near_relative(dem_region_volume(&cylinder), RIDDLE_PI * 0.75, 1e-15, "cylinder");
    near_relative(dem_region_volume(&ball), RIDDLE_PI * 32.0 / 3.0, 1e-15, "sphere");
    assert_true(dem_region_holds(&box, v3(1, 3, 2)) && !dem_region_holds(&box, v3(1.0001, 1, 2)));
    assert_true(dem_region_holds(&cylinder, v3(0.4, -2.9, 1.2)) && !dem_region_holds(&cylinder, v3(0.4, 0.1, 1.2)) &&
                !dem_region_holds(&cylinder, v3(0.4, -1, 1.31)));
    assert_true(dem_region_holds(&ball, v3(1, 1, 3)) && !dem_region_holds(&ball, v3(1, 2.3, 2.6)));
    const dem_region wrong[] = {dem_box_region(v3(1, 0, 0), v3(0, 1, 1)),
                                dem_box_region(v3(nan_, 0, 0), v3(0, 1, 1)),
                                dem_box_region(v3(0, 0, 0), v3(inf, 1, 1)),
                                dem_sphere_region(v3(0, 0, 0), -1.0),
                                dem_sphere_region(v3(0, 0, 0), nan_),
                                dem_cylinder_region(v3(0, 0, 0), v3(0, 0, 0), 1.0, 1.0),
                                dem_cylinder_region(v3(0, 0, 0), v3(0, 0, 1), -1.0, 1.0)};
    dem_world w = plain_world();
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        dem_feed feed = dem_default_feed();
        feed.region = wrong[k];
        assert_true(isnan(dem_region_volume(&wrong[k])) && !dem_region_holds(&wrong[k], v3(0, 0, 0)));
        assert_int_equal(dem_remove_region(&w, &wrong[k]), -(int)DEM_BAD_ARGUMENT);
        assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT);
    }
    assert_true(isnan(dem_region_volume(NULL)) && !dem_region_holds(NULL, v3(0, 0, 0)));
    dem_free(&w);
}

/* ---- hostile input ---- */

static void test_bad_feeds(void **state) {
    (void)state;
    dem_world w = plain_world(), empty;
    memset(&empty, 0, sizeof empty);
    dem_feed feed = dem_default_feed(), f;
    assert_int_equal(dem_fill(NULL, &feed, 1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fill(&empty, &feed, 1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fill(&w, NULL, 1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fill(&w, &feed, -1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fill(&w, &feed, PTRDIFF_MAX), DEM_TOO_MANY);
    assert_int_equal(dem_fill_mass(&w, &feed, nan_), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fill_mass(&w, &feed, inf), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fill_mass(&w, &feed, 1e300), DEM_TOO_MANY);
    assert_int_equal(dem_feed_mass(&w, &feed, -1.0, 1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_feed_mass(&w, &feed, 1.0, nan_), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_feed_number(&w, &feed, inf, 1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_feed_number(&w, &feed, 1e200, 1e200), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_remove_region(NULL, &feed.region), -(int)DEM_BAD_ARGUMENT);
    assert_int_equal(dem_remove_region(&w, NULL), -(int)DEM_BAD_ARGUMENT);
    for (int k = 0; k < 10; k++) {
        f = feed;
        if (k == 0) f.material = 1;
        if (k == 1) f.material = -1;
        if (k == 2) f.tries = 0;
        if (k == 3) f.velocity.y = nan_;
        if (k == 4) f.scatter.z = -1.0;
        if (k == 5) f.sizes = dem_one_size(1e-300); /* its mass is no number */
        if (k == 6) f.sizes.kind = (dem_size_kind)9;
        if (k == 7) f.region.kind = (dem_region_kind)9;
        if (k == 8) f.waiting = nan_;
        if (k == 9) f.waiting = 5e-324;
        assert_int_equal(dem_fill(&w, &f, 1), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_feed_number(&w, &f, 1.0, 1.0), DEM_BAD_ARGUMENT);
    }
    assert_int_equal(w.count, 0);
    f = feed; /* enormous and far away */
    f.region = dem_box_region(v3(-1e90, -1e90, -1e90), v3(1e90, 1e90, 1e90));
    f.sizes = dem_one_size(1e10);
    assert_int_equal(dem_fill(&w, &f, 10), DEM_OK);
    assert_int_equal(w.count, 10);
    assert_int_equal(dem_fill(&w, &f, 0), DEM_OK);
    assert_int_equal(dem_fill_mass(&w, &f, 0.0), DEM_OK);
    assert_int_equal(w.count, 10);
    f = feed;
    f.region = dem_box_region(v3(-1e308, 0, 0), v3(1e308, 1, 1)); /* its length is no number */
    dem_fill(&w, &f, 1);
    dem_free(&w);
}

/* A mass that no region of this size can hold is refused before anything is drawn; one that fits only just is tried. In
   a face, a disc and on a line, centres lie there and spheres stand out. */
static void test_mass_beyond_the_room(void **state) {
    (void)state;
    const double d = 0.01, density = 1000.0, one = density * RIDDLE_PI / 6.0 * d * d * d;
    double vertex[12] = {0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1};
    int32_t triangle[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2};
    dem_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.vertices = 4, mesh.triangles = 4, mesh.vertex = vertex, mesh.triangle = triangle;
    const struct {
        dem_region region;
        double most; /* volume [m3] */
    } list[] = {{dem_box_region(v3(0, 0, 0), v3(0.1, 0.05, 0.02)), 1e-4},
                {dem_box_region(v3(0, 0, 3), v3(0.1, 0.1, 3)), 0.01 * d},
                {dem_box_region(v3(1, 0, 3), v3(1, 0.1, 3)), 0.1 * d * d},
                {dem_box_region(v3(1, 2, 3), v3(1, 2, 3)), d * d * d},
                {dem_sphere_region(v3(0, 0, 0), 0.03), 4.0 / 3.0 * RIDDLE_PI * 2.7e-5},
                {dem_cylinder_region(v3(0, 0, 0), v3(1, 1, 0), 0.1, 0.02), RIDDLE_PI * 4e-5},
                {dem_cylinder_region(v3(0, 0, 0), v3(0, 0, 1), 0.0, 0.02), RIDDLE_PI * 4e-4 * d},
                {dem_mesh_region(&mesh), 1e-3}};
    dem_def def = dem_default_def();
    dem_add_material(&def, density, 1e7, 0.3);
    for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
        dem_feed feed = dem_default_feed(), before;
        dem_world w;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        feed.region = list[k].region, feed.sizes = dem_one_size(d), feed.tries = 10;
        before = feed;
        assert_int_equal(dem_fill_mass(&w, &feed, 1e6), DEM_TOO_MANY);
        assert_int_equal(dem_fill_mass(&w, &feed, 1.001 * density * list[k].most), DEM_TOO_MANY);
        assert_true(w.count == 0 && feed.random == before.random && feed.missed == 0 && feed.waiting == 0.0);
        const double mass = 0.999 * density * list[k].most;
        assert_int_equal(dem_fill_mass(&w, &feed, mass), DEM_OK);
        assert_true(w.count > 0 && fabs((double)(feed.placed + feed.missed) - mass / one) <= 0.5);
        dem_free(&w);
    }
}

/* A region may lie boxes away from a periodic box. */
static void test_fill_outside_a_box(void **state) {
    (void)state;
    const double at[] = {0.0, 0.25, -50.0};
    for (int k = 0; k < 3; k++) {
        dem_world w;
        dem_def def = plain_def(NULL);
        dem_feed feed = dem_default_feed();
        def.periodic[0] = 1, def.high = v3(0.1, 1, 1);
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        feed.region = dem_box_region(v3(at[k], 0, 0), v3(at[k] + 0.05, 0.1, 0.1));
        feed.sizes = dem_one_size(4e-3);
        assert_int_equal(dem_fill(&w, &feed, 200), DEM_OK);
        assert_int_equal(w.count, 200);
        for (ptrdiff_t i = 0; i < w.count; i++) {
            for (ptrdiff_t j = 0; j < i; j++) assert_true(closest_gap(&w, i, j) > -1e-12);
        }
        dem_free(&w);
    }
}

static void test_memory(void **state) {
    (void)state;
    for (int k = 0;; k++) {
        failing_allocator memory;
        failing_init_at(&memory, k);
        const dem_allocator hook = {failing_fn, &memory};
        dem_def def = plain_def(&hook);
        dem_world w;
        dem_feed feed = dem_default_feed(), before = feed;
        dem_status status = dem_init(&w, &def, NULL);
        if (status == DEM_OUT_OF_MEMORY) { /* nothing is allocated then */
            assert_int_equal(failing_live(&memory), 0);
            continue;
        }
        assert_int_equal(status, DEM_OK);
        status = dem_fill(&w, &feed, 100);
        if (status == DEM_OK) {
            before = feed;
            status = dem_feed_mass(&w, &feed, 0.01, 0.1);
        }
        assert_true(status == DEM_OK || status == DEM_OUT_OF_MEMORY);
        assert_int_equal(w.count, status == DEM_OK ? feed.placed : before.placed);
        if (status != DEM_OK) assert_memory_equal(&feed, &before, sizeof feed);
        dem_free(&w);
        assert_int_equal(failing_live(&memory), 0);
        if (!memory.has_failed) break;
        assert_true(k < 50);
    }
}

/* ---- from a table ---- */

static void test_start_from_a_table(void **state) {
    (void)state;
    particles p;
    char message[200] = "";
    const char *const text =
        "# comment\nx_m,y,z,diameter_m,vx,vy,vz_m_s,class\n0.1,-2e-3,0.3,0.005,1,2,3,7\n0,0,1,0.01,,,,\n";
    assert_int_equal(particles_parse(text, strlen(text), "a.csv", &p, message, sizeof message),
                     -1); /* an empty velocity is not a number */
    assert_string_equal(message, "a.csv:4: column vx: '' is not a number");
    const char *const good = "x_m,y,z,radius,vx,vy,vz_m_s,class,omega_x,omega_y,omega_z\n0.1,-2e-3,0.3,0.0025,1,2,3,7,"
                             "4,5,6\n0,0,1,0.005,0,0,0,0,0,0,0\n";
    assert_int_equal(particles_parse(good, strlen(good), "a.csv", &p, message, sizeof message), 0);
    assert_true(p.n == 2 && p.centre[0] == 0.1 && p.centre[1] == -2e-3 && p.centre[5] == 1.0 &&
                p.diameter[0] == 0.005 && p.diameter[1] == 0.01);
    assert_true(p.velocity[2] == 3.0 && p.velocity[3] == 0.0 && p.spin[0] == 4.0 && p.spin[2] == 6.0 &&
                p.group[0] == 7 && p.group[1] == 0);

    /* written as .vtp and read again: the same to single precision, and into a world */
    dem_world w = plain_world();
    const riddle_io_array arrays[] = {riddle_io_scalar("diameter_m", p.diameter),
                                      riddle_io_vector("velocity_m_s", p.velocity),
                                      riddle_io_vector("spin_rad_s", p.spin), riddle_io_ints("class", p.group)};
    const char *folder = getenv("TMPDIR");
    char path[600];
    snprintf(path, sizeof path, "%s/riddle-%06.0f.vtp", folder ? folder : "/tmp", fmod(machine_seconds() * 1e6, 1e6));
    assert_int_equal(riddle_io_points(NULL, path, p.n, riddle_io_vector("position", p.centre), arrays, 4), 0);
    particles q;
    assert_int_equal(particles_read(path, &q, message, sizeof message), 0);
    assert_int_equal(q.n, 2);
    for (int k = 0; k < 6; k++) {
        near_absolute(q.centre[k], p.centre[k], 1e-7, "centre");
        near_absolute(q.velocity[k] + q.spin[k], p.velocity[k] + p.spin[k], 1e-6, "velocity, spin");
    }
    assert_true(q.group[0] == 7 && fabs(q.diameter[0] - 0.005) < 1e-9);
    assert_int_equal(dem_add_spheres(&w, q.n, q.centre, q.diameter, 0, 0), DEM_OK);
    particles_free(&q);

    /* cut short or with a byte changed: a message or a table, never a crash */
    FILE *file = fopen(path, "rb");
    static char bytes[8192], damaged[8192];
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    remove(path);
    scene_random r = {9};
    int refused = 0;
    for (int k = 0; k < 20000; k++) {
        const size_t length = k % 3 ? size : (size_t)(scene_uniform(&r) * (double)size);
        memcpy(damaged, bytes, size);
        for (int b = 0; b < 1 + k % 4; b++)
            damaged[(size_t)(scene_uniform(&r) * (double)size)] = (char)(unsigned char)(scene_uniform(&r) * 256.0);
        char *exact = malloc(length + 1); /* so that a sanitizer sees a read past the end */
        memcpy(exact, damaged, length);
        message[0] = '\0';
        const int status = particles_parse(exact, length, "a.vtp", &q, message, sizeof message);
        assert_true(status == 0 ? q.n >= 0 && !message[0] : message[0] && !q.memory);
        refused += status != 0;
        particles_free(&q);
        free(exact);
    }
    assert_true(refused > 8000 && refused < 20000);
    particles_free(&p);
    static const char *const bad[] = {"",
                                      "x,y,z\n1,2,3\n",
                                      "x,y,diameter\n1,2,3\n",
                                      "x,y,z,diameter\n1,2,3,0\n",
                                      "x,y,z,diameter\n1,2,nan,1\n",
                                      "x,y,z,diameter\n1,inf,3,1\n",
                                      "x,y,z,radius\n1,2,3,a\n"};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        assert_int_equal(particles_parse(bad[k], strlen(bad[k]), "a.csv", &p, message, sizeof message), -1);
        assert_true(message[0] && !p.memory);
    }
    assert_int_equal(particles_read("/nowhere/a.csv", &p, message, sizeof message), -1);
    dem_free(&w);
}

/* ---- a host that stops ---- */

typedef struct stopper {
    dem_world *world;
    int calls, at;
    dem_status inside; /* of a call that would change the world */
} stopper;

static int stop_at(void *user) {
    stopper *s = (stopper *)user;
    const double at[3] = {1.0, 1.0, 1.0}, d = 1e-3;
    if (s->calls++ == 0) s->inside = dem_add_spheres(s->world, 1, at, &d, 0, 0);
    return s->calls >= s->at;
}

static dem_status put(dem_world *w, dem_feed *feed, int how) {
    if (how == 0) return dem_fill(w, feed, 3000);
    if (how == 1) return dem_fill_mass(w, feed, 3000 * 1.3e-6);
    return how == 2 ? dem_feed_number(w, feed, 3e5, 0.01) : dem_feed_mass(w, feed, 3000 * 1.3e-4, 0.01);
}

/* Stopped early or late: neither world nor feed has changed; not stopped: as if nobody had asked. */
static void test_stopped_by_its_host(void **state) {
    (void)state;
    for (int k = 0; k < 4 * 3; k++) {
        dem_world w = plain_world(), unasked = plain_world();
        dem_feed feed = dem_default_feed(), other = feed;
        stopper s = {&w, 0, 1 + 2 * (k % 3), DEM_OK};
        feed.region = other.region = dem_box_region(v3(0, 0, 0), v3(0.02, 0.02, 0.02));
        feed.sizes = other.sizes = dem_lognormal_sizes(1e-3, 0.2, 5e-4, 2e-3, k % 2);
        assert_int_equal(dem_fill(&w, &feed, 50), DEM_OK);
        assert_int_equal(dem_fill(&unasked, &other, 50), DEM_OK);
        const uint64_t hash = dem_hash(&w);
        const dem_feed before = feed;
        w.def.stop = stop_at, w.def.stop_user = &s;
        assert_int_equal(put(&w, &feed, k / 3), DEM_STOPPED);
        assert_true(s.calls == s.at && s.inside == DEM_BUSY && w.count == 50 && dem_hash(&w) == hash);
        assert_memory_equal(&feed, &before, sizeof feed);
        s.at = INT32_MAX;
        assert_int_equal(put(&w, &feed, k / 3), DEM_OK);
        assert_int_equal(put(&unasked, &other, k / 3), DEM_OK);
        assert_true(w.count > 1000 && dem_hash(&w) == dem_hash(&unasked));
        assert_memory_equal(&feed, &other, sizeof feed);
        dem_free(&w);
        dem_free(&unasked);
    }
}

/* ---- sources of several classes ---- */

enum { CLASSES = 4 };

static dem_source make_source(dem_feed *feed, const double *share) {
    static const double diameter[CLASSES] = {30e-3, 10e-3, 12e-3, 6e-3};
    dem_source source;
    memset(&source, 0, sizeof source);
    for (int k = 0; k < CLASSES; k++) {
        feed[k] = dem_default_feed();
        feed[k].region = dem_box_region(v3(0, 0, 0.2), v3(0.1, 0.1, 0.28));
        feed[k].sizes = k == 2 ? dem_uniform_sizes(0.8 * diameter[k], diameter[k], 1) : dem_one_size(diameter[k]);
        feed[k].group = k, feed[k].velocity = v3(0, 0, -1.0), feed[k].tries = 50;
    }
    source.feed = feed, source.share = share, source.classes = CLASSES;
    return source;
}

/* Shares are exact to a body whatever finds room: of a feed of four classes, at rates of which the box takes all, half
   and next to nothing. */
static void test_shares_whatever_the_rate(void **state) {
    const double share[CLASSES] = {3.0, 2.0, 0.0, 1.0}, all = 6.0;
    (void)state;
    for (int k = 0; k < 6; k++) {
        const double rate = k % 3 == 0 ? 2.0 : k % 3 == 1 ? 30.0 : 3000.0;
        dem_feed feed[CLASSES];
        dem_source source = make_source(feed, share);
        dem_world w = plain_world();
        double mass = 0.0, number = 0.0;
        source.by_number = k >= 3;
        assert_true(dem_add_exit(&w, v3(0, 0, 0), v3(0, 0, 1)) >= 0);
        for (int step = 0; step < 30; step++) {
            assert_int_equal(source.by_number ? dem_feed_source(&w, &source, 50.0 * rate, 0.02)
                                              : dem_feed_source_mass(&w, &source, rate, 0.02),
                             DEM_OK);
            assert_int_equal(dem_run(&w, 0.02, DEM_LINEAR), DEM_OK);
        }
        for (int c = 0; c < CLASSES; c++) mass += feed[c].placed_mass, number += (double)feed[c].placed;
        const double heaviest = 2500.0 * RIDDLE_PI / 6.0 * 27e-6;
        if (source.by_number) near_absolute(source.due, 30 * 50.0 * rate * 0.02 - number, 1e-6, "owed");
        else near_absolute(source.due_mass, 30 * rate * 0.02 - mass, 1e-9, "owed");
        assert_true(k % 3 == 0 || (source.by_number ? source.due > 100.0 : source.due_mass > 5.0));
        for (int c = 0; c < CLASSES; c++) {
            const double wanted = share[c] / all * (source.by_number ? number : mass);
            near_absolute(source.by_number ? (double)feed[c].placed : feed[c].placed_mass, wanted,
                          source.by_number ? 1.0 : heaviest, "share");
            assert_true(feed[c].missed == 0);
        }
        assert_true(feed[2].placed == 0 && feed[0].placed > (k % 3 == 0 ? 5 : 10));
        dem_free(&w);
    }
}

/* One class is a feed: the same bits. A fill counts by class what finds no place, and has the mass that
   was asked for. */
static void test_sources_fill(void **state) {
    const double one = 0.3, share[CLASSES] = {0.4, 0.3, 0.2, 0.1};
    dem_world w = plain_world(), other = plain_world();
    dem_feed feed = dem_default_feed(), same, classes[CLASSES];
    dem_source source;
    (void)state;
    feed.region = dem_box_region(v3(0, 0, 0), v3(0.02, 0.02, 0.02));
    feed.sizes = dem_lognormal_sizes(1e-3, 0.2, 5e-4, 2e-3, 1), feed.scatter = v3(0.1, 0.1, 0.1);
    same = feed;
    memset(&source, 0, sizeof source);
    source.feed = &same, source.share = &one, source.classes = 1;
    assert_int_equal(dem_fill_mass(&w, &feed, 5e-4), DEM_OK);
    assert_int_equal(dem_fill_source_mass(&other, &source, 5e-4), DEM_OK);
    assert_int_equal(dem_feed_number(&w, &feed, 1e4, 0.01), DEM_OK);
    assert_int_equal(dem_feed_source(&other, &source, 1e4, 0.01), DEM_OK);
    assert_true(w.count > 200 && dem_hash(&w) == dem_hash(&other) && feed.random == same.random &&
                feed.due == source.due);
    dem_free(&w), dem_free(&other);

    source = make_source(classes, share);
    w = plain_world();
    assert_int_equal(dem_fill_source_mass(&w, &source, 1.0), DEM_OK); /* more than finds room */
    double asked = 0.0, missed = 0.0;
    for (int c = 0; c < CLASSES; c++)
        asked += classes[c].placed_mass + classes[c].missed_mass, missed += classes[c].missed_mass;
    const double heaviest = 2500.0 * RIDDLE_PI / 6.0 * 27e-6;
    near_absolute(asked, 1.0, 0.5 * heaviest, "mass asked for");
    assert_true(missed > 0.01);
    for (int c = 0; c < CLASSES; c++)
        near_absolute(classes[c].placed_mass + classes[c].missed_mass, share[c] * asked, heaviest, "share");
    nothing_overlaps(&w);
    assert_int_equal(dem_fill_source(&w, &source, 0), DEM_OK);
    assert_int_equal(dem_fill_source_mass(&w, &source, 1e9), DEM_TOO_MANY);
    dem_free(&w);
}

/* A diameter that was drawn ahead belongs to the sizes, and the shape, that it was drawn from. */
static void test_feed_with_other_sizes(void **state) {
    static const double sizes[3] = {5e-3, 7e-3, 10e-3};
    dem_world w = plain_world();
    dem_feed feed = dem_default_feed();
    (void)state;
    feed.region = dem_box_region(v3(0, 0, 0), v3(0.2, 0.2, 0.2));
    for (int k = 0; k < 6; k++) {
        const ptrdiff_t from = w.count;
        const double d = sizes[k % 3];
        feed.sizes = k < 3 ? dem_one_size(d) : dem_uniform_sizes(d, 1.01 * d, k % 2);
        assert_int_equal(dem_fill_mass(&w, &feed, 60.4 * 2500.0 * RIDDLE_PI / 6.0 * d * d * d), DEM_OK);
        assert_true(w.count > from && feed.waiting >= d && feed.waiting <= 1.01 * d);
        for (ptrdiff_t i = from; i < w.count; i++)
            assert_true(2.0 * dem_radius(&w, i) > d - 1e-12 && 2.0 * dem_radius(&w, i) < 1.01 * d + 1e-12);
    }
    feed.sizes.share[0] = 7.0; /* beyond what a distribution uses: nothing of it */
    const double kept = feed.waiting;
    assert_int_equal(dem_feed_number(&w, &feed, 0.0, 1.0), DEM_OK);
    assert_true(feed.waiting == kept);
    dem_free(&w);
}

static void test_bad_sources(void **state) {
    double share[CLASSES] = {0.4, 0.3, 0.2, 0.1};
    dem_feed feed[CLASSES];
    dem_world w = plain_world(), empty;
    const dem_source good = make_source(feed, share);
    memset(&empty, 0, sizeof empty);
    (void)state;
    for (int k = 0; k < 14; k++) {
        double odd[CLASSES] = {0.4, 0.3, 0.2, 0.1};
        dem_feed changed[CLASSES];
        dem_source s = good;
        memcpy(changed, feed, sizeof feed);
        s.feed = changed, s.share = odd;
        if (k == 0) s.feed = NULL;
        if (k == 1) s.share = NULL;
        if (k == 2) s.classes = 0;
        if (k == 3) s.classes = DEM_CLASSES_MAX + 1;
        if (k == 4) odd[1] = nan_;
        if (k == 5) odd[1] = -0.1;
        if (k == 6) odd[0] = odd[1] = odd[2] = odd[3] = 0.0;
        if (k == 7) odd[2] = inf;
        if (k == 8) s.due = nan_;
        if (k == 9) s.due_mass = inf;
        if (k == 10) changed[3].sizes.diameter[0] = nan_;
        if (k == 11) changed[2].material = 7;
        if (k == 12) s.classes = INT32_MIN;
        if (k == 13) changed[1].tries = 0;
        assert_int_equal(dem_fill_source(&w, &s, 1), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_fill_source_mass(&w, &s, 1e-3), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_feed_source(&w, &s, 1.0, 1.0), DEM_BAD_ARGUMENT);
        assert_int_equal(dem_feed_source_mass(&w, &s, 1.0, 1.0), DEM_BAD_ARGUMENT);
    }
    dem_source s = good;
    assert_int_equal(dem_fill_source(NULL, &s, 1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fill_source(&empty, &s, 1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fill_source(&w, NULL, 1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fill_source(&w, &s, -1), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_fill_source_mass(&w, &s, nan_), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_feed_source(&w, &s, -1.0, 1.0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_feed_source_mass(&w, &s, 1e200, 1e200), DEM_BAD_ARGUMENT);
    assert_true(w.count == 0);
    dem_free(&w);
}

/* Out of memory anywhere: neither world nor source has changed. Spheres, clumps and clumps of another kind
   in one source. */
static void test_memory_of_sources(void **state) {
    static const double centres[6] = {0, 0, 0, 1, 0, 0}, diameters[2] = {1.2, 1.0};
    const double share[CLASSES] = {0.4, 0.3, 0.2, 0.1};
    dem_clump pair;
    (void)state;
    assert_int_equal(dem_make_clump(2, centres, diameters, &pair), DEM_OK);
    for (int k = 0;; k++) {
        failing_allocator memory;
        failing_init_at(&memory, k);
        const dem_allocator hook = {failing_fn, &memory};
        dem_def def = plain_def(&hook);
        dem_world w;
        dem_feed feed[CLASSES], before[CLASSES];
        dem_source source = make_source(feed, share);
        feed[1].clump = feed[3].clump = &pair;
        dem_status status = dem_init(&w, &def, NULL);
        if (status == DEM_OUT_OF_MEMORY) continue;
        assert_int_equal(status, DEM_OK);
        for (int call = 0; call < 3 && status == DEM_OK; call++) {
            const dem_source was = source;
            const ptrdiff_t count = w.count;
            memcpy(before, feed, sizeof feed);
            status = call == 0 ? dem_fill_source(&w, &source, 60) : dem_feed_source_mass(&w, &source, 1.0, 0.1);
            assert_true(status == DEM_OK || status == DEM_OUT_OF_MEMORY);
            if (status == DEM_OK) continue;
            assert_true(w.count == count && source.due_mass == was.due_mass);
            assert_memory_equal(feed, before, sizeof feed);
        }
        if (status == DEM_OK) assert_true(feed[1].placed > 2 && feed[3].placed > 2 && feed[0].placed > 0);
        dem_free(&w);
        assert_int_equal(failing_live(&memory), 0);
        if (!memory.has_failed) break;
        assert_true(k < 80);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_near_pairs_of_any_size),
        cmocka_unit_test(test_strays_do_not_spoil_the_cells),
        cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_bad_sizes),
        cmocka_unit_test(test_fill),
        cmocka_unit_test(test_fill_among_others),
        cmocka_unit_test(test_fill_tells_what_it_missed),
        cmocka_unit_test(test_fill_outside_a_box),
        cmocka_unit_test(test_feed_in_time),
        cmocka_unit_test(test_feed_owes_half_a_sphere),
        cmocka_unit_test(test_sizes_cut_far_out),
        cmocka_unit_test(test_feed_waits),
        cmocka_unit_test(test_feed_restarts),
        cmocka_unit_test(test_remove_and_ledger),
        cmocka_unit_test(test_regions),
        cmocka_unit_test(test_bad_feeds),
        cmocka_unit_test(test_mass_beyond_the_room),
        cmocka_unit_test(test_memory),
        cmocka_unit_test(test_stopped_by_its_host),
        cmocka_unit_test(test_start_from_a_table),
        cmocka_unit_test(test_shares_whatever_the_rate),
        cmocka_unit_test(test_sources_fill),
        cmocka_unit_test(test_feed_with_other_sizes),
        cmocka_unit_test(test_bad_sources),
        cmocka_unit_test(test_memory_of_sources),
    };
    return cmocka_run_group_tests_name("dem_feed", tests, NULL, NULL);
}
