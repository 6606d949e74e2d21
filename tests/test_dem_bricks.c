/* Polyhedra as particles of dem.h: at rest, sliding, tipping, rocking, in hits, rebounding; with spheres, walls,
   threads, saves. */
#include "dem.h"
#include "../examples/common/random.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#include "near.h"

static uint64_t seed = 1;
/* A world of one material, 1000 kg/m3. */
static void make(dem_world *w, double dt, double k, double e, double friction, double tangential_ratio, dem_vec gravity,
                 int threads) {
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 1000.0, 1e7, 0.3);
    dem_pair_def *pair = dem_pair(&def, m, m);
    pair->stiffness = k, pair->restitution = e, pair->friction = friction, pair->tangential_ratio = tangential_ratio;
    def.dt = dt, def.gravity = gravity, def.threads = threads;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
}
static int brick(dem_world *w, double a, double b, double c, double rounding) {
    dem_convex s;
    assert_int_equal(dem_make_brick(&s, dem_vec3(a, b, c), rounding, NULL), DEM_OK);
    const int shape = dem_add_shape(w, &s);
    assert_true(shape >= 0);
    return shape;
}
static void put(dem_world *w, int shape, double x, double y, double z, double q0, double q1, double q2, double q3) {
    const double at[3] = {x, y, z}, q[4] = {q0, q1, q2, q3};
    assert_int_equal(dem_add_convex(w, shape, 1, at, q, 0, 0), DEM_OK);
}
static void ground(dem_world *w) { assert_int_equal(dem_add_plane(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)), 0); }

#define RUN(w, time) assert_int_equal(dem_run(w, time, DEM_LINEAR | DEM_FRICTION), DEM_OK)

/* Standing, it sinks by m g/k; on a face of another brick as well. */
static void test_rest(void **state) {
    (void)state;
    dem_world w;
    make(&w, 1e-5, 1e4, 0.5, 0.5, 0.8, dem_vec3(0, 0, -9.81), 1);
    ground(&w);
    const int shape = brick(&w, 0.01, 0.01, 0.0208, 0.03), slab = brick(&w, 0.03, 0.03, 0.01, 0.03);
    put(&w, shape, 0, 0, 0.0104, 1, 0, 0, 0);
    put(&w, slab, 0.1, 0, 0.005, 1, 0, 0, 0);
    put(&w, shape, 0.1, 0, 0.0204, 1, 0, 0, 0);
    RUN(&w, 2.0);
    const double m = dem_mass(&w, 0), load = m + dem_mass(&w, 1);
    near(0.0104 - dem_position(&w, 0).z, m * 9.81 / 1e4, 1e-12);
    near(0.005 - dem_position(&w, 1).z, load * 9.81 / 1e4, 1e-11);
    near(dem_position(&w, 1).z + 0.0154 - dem_position(&w, 2).z, m * 9.81 / 1e4, 1e-11);
    assert_int_equal(dem_contact_count(&w), 12);
    assert_int_equal(dem_core_overlaps(&w), 0);
    dem_free(&w);
}

/* A step that cannot be finished, because a pair of materials has no constants, leaves no trace in the orientation of a
   brick that tumbles in contact: after the pair is set, the run goes on like one that had it from the start, although
   a new wall asks for the forces anew. */
static void test_failed_step_turns_nothing(void **state) {
    (void)state;
    static const double above[3] = {0, 0, 0.03}, d = 0.005;
    uint64_t hash[2];
    int64_t failed_at = 0;
    for (int later = 1; later >= 0; later--) {
        dem_def def = dem_default_def();
        dem_world w;
        for (int k = 0; k < 2; k++) dem_add_material(&def, 1000.0, 1e7, 0.3);
        dem_pair_def *own = dem_pair(&def, 0, 0);
        own->stiffness = 1e4, own->restitution = 0.5, own->friction = 0.5;
        if (!later) *dem_pair(&def, 0, 1) = *own;
        def.dt = 1e-5;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        ground(&w);
        put(&w, brick(&w, 0.01, 0.01, 0.0208, 0.03), 0, 0, 0.0104, 1, 0, 0, 0);
        assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0, 0, 0), dem_vec3(3, 2, 5)), DEM_OK);
        assert_int_equal(dem_add_spheres(&w, 1, above, &d, 1, 0), DEM_OK);
        if (later) {
            assert_int_equal(dem_run(&w, 1.0, DEM_LINEAR | DEM_FRICTION), DEM_PAIR_NOT_SET);
            failed_at = w.step;
            assert_true(failed_at > 100 && dem_contact_count(&w) > 0);
            *dem_pair(&w.def, 0, 1) = *dem_pair(&w.def, 0, 0);
        } else RUN(&w, (double)failed_at * def.dt);
        assert_int_equal(w.step, failed_at);
        assert_int_equal(dem_add_plane(&w, 0, dem_vec3(-1, 0, 0), dem_vec3(1, 0, 0)), 1);
        RUN(&w, 0.01);
        hash[later] = dem_hash(&w);
        dem_free(&w);
    }
    assert_true(hash[0] == hash[1]);
}

/* What is read of a contact is what acts: its normal, point and force give the force and the torque that a fixed body
   and a wall feel. A cube and a ball slide and roll over a fixed brick, across a periodic edge, another cube over a
   tilted plane. */
static void test_contacts_read(void **state) {
    (void)state;
    dem_def def = dem_default_def();
    dem_world w;
    dem_add_material(&def, 1000.0, 1e7, 0.3);
    dem_pair_def *pair = dem_pair(&def, 0, 0);
    pair->stiffness = 2e3, pair->restitution = 0.6, pair->friction = 0.5;
    def.dt = 1e-5, def.periodic[0] = 1, def.low = dem_vec3(-0.05, -1, -1), def.high = dem_vec3(0.05, 1, 1);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    const int cube = brick(&w, 0.01, 0.01, 0.01, 0.05), slab = brick(&w, 0.03, 0.03, 0.01, 0.05);
    const int plane = dem_add_plane(&w, 0, dem_vec3(0, 0.2, 0), dem_vec3(0, 0.2, 1));
    const double at[3] = {-0.049, 0.004, 0.0074}, d = 5e-3, high[3] = {0.01, 0.2, 0.0085}, turn[4] = {1, 0.3, 0.1, 0.2};
    put(&w, slab, 0.049, 0, 0, 1, 0.1, 0.05, 0.2);
    assert_int_equal(dem_fix(&w, 0, 1), DEM_OK);
    put(&w, cube, 0.044, -0.006, 0.0145, 1, 0.3, 0.1, 0.2);
    assert_int_equal(dem_add_convex(&w, cube, 1, high, turn, 0, 1), DEM_OK);
    assert_int_equal(dem_add_spheres(&w, 1, at, &d, 0, 0), DEM_OK);
    dem_set_wall_groups(&w, plane, 2u);
    double worst = 0.0, rubs = 0.0;
    int seen = 0, pairs = 0;
    for (int k = 0; k < 600; k++) {
        dem_vec force, torque, impulse, on_body = {0, 0, 0}, twist = {0, 0, 0}, on_wall = {0, 0, 0},
                                        wall_twist = {0, 0, 0};
        RUN(&w, 1e-4);
        assert_int_equal(dem_get_fixed_force(&w, 0, &force, &torque, &impulse), DEM_OK);
        for (ptrdiff_t q = 0; q < dem_contact_count(&w); q++) {
            const dem_contact_info c = dem_get_contact(&w, q);
            const dem_vec f = c.force, x = c.j < 0 ? w.wall[plane].position : dem_position(&w, 0);
            dem_vec r = dem_vec3(c.point.x - x.x, c.point.y - x.y, c.point.z - x.z);
            r.x -= 0.1 * floor(r.x / 0.1 + 0.5);
            const dem_vec own = c.couple;
            dem_vec t = dem_vec3(r.y * f.z - r.z * f.y, r.z * f.x - r.x * f.z, r.x * f.y - r.y * f.x);
            t.x += own.x, t.y += own.y, t.z += own.z;
            const double along = f.x * c.normal.x + f.y * c.normal.y + f.z * c.normal.z;
            const double aside = sqrt(fabs(f.x * f.x + f.y * f.y + f.z * f.z - along * along));
            dem_vec *sum = c.j < 0 ? &on_wall : &on_body, *moment = c.j < 0 ? &wall_twist : &twist;
            const double sign = c.j < 0 ? -1.0 : c.i == 0 ? 1.0 : -1.0;
            if (c.j > 0 && c.i != 0) continue; /* the slab's alone */
            sum->x += sign * f.x, sum->y += sign * f.y, sum->z += sign * f.z, moment->x += sign * t.x,
                moment->y += sign * t.y, moment->z += sign * t.z;
            near(c.normal.x * c.normal.x + c.normal.y * c.normal.y + c.normal.z * c.normal.z, 1.0, 1e-12);
            assert_true(aside <= 0.5 * fabs(along) * (1 + 1e-9) + 1e-12);
            rubs = fmax(rubs, aside / (fabs(along) + 1e-12)), seen++, pairs += c.j >= 0;
        }
        worst = fmax(worst, fabs(force.x - on_body.x) + fabs(force.y - on_body.y) + fabs(force.z - on_body.z));
        worst = fmax(worst, 100.0 * (fabs(torque.x - twist.x) + fabs(torque.y - twist.y) + fabs(torque.z - twist.z)));
        worst = fmax(worst, fabs(w.wall[plane].force.x - on_wall.x) + fabs(w.wall[plane].force.z - on_wall.z));
        worst = fmax(
            worst, 100.0 * (fabs(w.wall[plane].torque.x - wall_twist.x) + fabs(w.wall[plane].torque.z - wall_twist.z)));
    }
    assert_true(pairs > 50 && seen - pairs > 20 && rubs > 0.4);
    near(worst, 0.0, 1e-13);
    dem_free(&w);
}

/* Down a slope of 30 degrees: g (sin - mu cos). */
static void test_slide(void **state) {
    (void)state;
    dem_world w;
    make(&w, 1e-5, 1e4, 0.5, 0.3, 0.8, dem_vec3(9.81 * 0.5, 0, -9.81 * sqrt(0.75)), 1);
    ground(&w);
    const int shape = brick(&w, 0.01, 0.01, 0.0208, 0.03);
    put(&w, shape, 0, 0, 0.005 - 1000 * 2.08e-6 * 9.81 * sqrt(0.75) / 1e4, 1, 1, 0, 0);
    RUN(&w, 0.2);
    const double before = dem_velocity(&w, 0).x;
    RUN(&w, 0.2);
    near((dem_velocity(&w, 0).x - before) / 0.2, 2.3562872366624, 1e-8);
    dem_free(&w);
}

/* Does it stand on a slope that is raised slowly to this angle [degrees]? q: its orientation, height: of its centre. */
static int stands(double degrees, double q0, double q2, double q3, double height) {
    dem_world w;
    make(&w, 5e-4, 1e8, 0.3, 5.0, 0.8, dem_vec3(0, 0, -9.81), 1);
    ground(&w);
    const int shape = brick(&w, 1.0, 1.0, 2.08, 0.002);
    put(&w, shape, 0, 0, height - 5e-5, q0, 0, q2, q3);
    for (int k = 1; k <= 60; k++) {
        const double angle = (k < 40 ? k / 40.0 : 1.0) * degrees * RIDDLE_PI / 180.0;
        assert_int_equal(dem_set_gravity(&w, dem_vec3(9.81 * sin(angle), 0, -9.81 * cos(angle))), DEM_OK);
        RUN(&w, 0.05);
    }
    const double fallen = fabs(dem_position(&w, 0).z - height);
    dem_free(&w);
    return fallen < 0.02;
}
/* It tips where its centre of mass is above the edge, which the rounding brings in by 0.2 %: standing, lying along the
   slope, standing on an edge's direction. */
static void test_tip(void **state) {
    (void)state;
    assert_true(stands(25.6768156818382 - 0.5, 1, 0, 0, 1.04));
    assert_false(stands(25.6768156818382 + 0.5, 1, 0, 0, 1.04));
    assert_true(stands(64.3231843181618 - 0.5, 1, 1, 0, 0.5));
    assert_false(stands(64.3231843181618 + 0.5, 1, 1, 0, 0.5));
    assert_true(stands(34.2121902110491 - 0.5, 1, 0, sqrt(2.0) - 1.0, 1.04));
    assert_false(stands(34.2121902110491 + 0.5, 1, 0, sqrt(2.0) - 1.0, 1.04));
}

/* Housner's block (1963): from half its tipping angle it falls to upright in acosh(2)/p, linearised; then it goes on
   about the other edge with 1 - 1.5 sin^2 of the angle of its diagonal of its rate. */
static void test_rock(void **state) {
    (void)state;
    dem_world w;
    const double alpha = atan(1.0 / 2.08), theta = 0.5 * alpha, r = 0.5 * sqrt(1.0 + 2.08 * 2.08),
                 p = sqrt(0.75 * 9.81 / r);
    make(&w, 5e-5, 1e9, 0.02, 5.0, 0.8, dem_vec3(0, 0, -9.81), 1);
    dem_pair_def stuck = *dem_pair(&w.def, 0, 0);
    stuck.tangential_damping = 1.0; /* the edge that is hit does not spring sideways */
    assert_int_equal(dem_set_pair(&w, 0, 0, &stuck), DEM_OK);
    ground(&w);
    const int shape = brick(&w, 1.0, 1.0, 2.08, 0.002);
    put(&w, shape, 0, 0, r * cos(alpha - theta) - 1e-5, cos(0.5 * theta), 0, sin(0.5 * theta), 0);
    /* the same without the small angle, of a body that turns about its edge */
    double x = theta, v = 0.0, exact = 0.0;
    for (const double h = 1e-5; x > 0.0; exact += h) {
        v -= h * p * p * sin(alpha - x) / 1.0;
        x += h * v;
    }
    double upright = 0.0, before = 0.0, after = 0.0;
    while (w.time < 0.7 && !(upright > 0.0 && w.time > upright + 0.03)) {
        RUN(&w, 1e-3);
        const dem_quaternion q = dem_orientation(&w, 0);
        /* its rate when upright, from that at an angle: rate^2/2 + p^2 cos(alpha - angle) is kept */
        const double own = dem_spin(&w, 0).y, gain = 2.0 * p * p * (cos(alpha - 2.0 * fabs(q.y)) - cos(alpha));
        const double rate = sqrt(own * own + gain);
        if (upright == 0.0 && q.y <= 1e-4) upright = w.time;
        if (upright == 0.0) before = rate;
        after = rate;
    }
    print_message("rocking: upright after %.4f s (%.4f, linearised %.4f), rate times %.4f (%.4f)\n", upright, exact,
                  acosh(2.0) / p, after / before, 1.0 - 1.5 * sin(alpha) * sin(alpha));
    near(upright, exact, 0.005);
    near(exact, acosh(2.0) / p, 0.01);
    near(after / before, 0.71838389906879, 0.02);
    dem_free(&w);
}

static double energy(const dem_world *w) {
    const dem_energy_ledger l = dem_energy(w);
    return l.kinetic + l.rotational;
}
static dem_vec angular(const dem_world *w) {
    dem_vec sum = dem_vec3(0, 0, 0);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem_body b = dem_get_body(w, i);
        const dem_vec own = dem__momentum_of(b.axes, b.moments, b.spin);
        sum = dem__add(sum, dem__add(own, dem__scale(b.mass, dem__cross(b.position, b.velocity))));
    }
    return sum;
}

/* Elastic hits of bricks by a law, at so many steps a contact: the root mean square error of the energy;
   momenta are kept. */
static double hit_error(int hits, double steps, double friction, int law) {
    double sum = 0.0;
    int n = 0;
    seed = 7;
    while (n < hits) {
        dem_world w;
        const double m = 2080.0, k = 0.5 * m / (0.025 * 0.025);
        make(&w, RIDDLE_PI * sqrt(0.5 * m / k) / steps, k, 1.0, friction, 0.8, dem_vec3(0, 0, 0), 1);
        const int shape = brick(&w, 1.0, 1.0, 2.08, 0.05);
        for (int i = 0; i < 2; i++)
            put(&w, shape, 2.6 * i, 0.5 * i * random_bell(&seed), 0.5 * i * random_bell(&seed), random_bell(&seed),
                random_bell(&seed), random_bell(&seed), random_bell(&seed));
        dem_set_motion(&w, 0, dem_vec3(0.5, 0, 0),
                       dem_vec3(0.3 * random_bell(&seed), 0.3 * random_bell(&seed), 0.3 * random_bell(&seed)));
        dem_set_motion(&w, 1, dem_vec3(-0.5, 0, 0),
                       dem_vec3(0.3 * random_bell(&seed), 0.3 * random_bell(&seed), 0.3 * random_bell(&seed)));
        const double before = energy(&w);
        const dem_vec turning = angular(&w);
        while (w.time < 3.0 || dem_contact_count(&w) > 0)
            assert_int_equal(dem_run(&w, 0.1, law | DEM_FRICTION), DEM_OK);
        assert_true(dem__length(dem_momentum(&w)) < 1e-13 * m);
        assert_true(dem__length(dem__sub(angular(&w), turning)) < 1e-13 * m);
        assert_int_equal(dem_core_overlaps(&w), 0);
        if (fabs(dem_velocity(&w, 0).x - 0.5) > 1e-12)
            sum += (energy(&w) / before - 1.0) * (energy(&w) / before - 1.0), n++;
        dem_free(&w);
    }
    return sqrt(sum / n);
}
static void test_hits(void **state) {
    (void)state;
    const double coarse = hit_error(100, 100, 0.0, DEM_LINEAR), fine = hit_error(60, 400, 0.0, DEM_LINEAR);
    const double hertz = hit_error(60, 400, 0.0, DEM_HERTZ);
    print_message("energy of a hit: rms error %.2g at t_n/100, %.2g at t_n/400, Hertz %.2g\n", coarse, fine, hertz);
    assert_true(coarse < 2e-4 && fine < 1e-5 && hertz < 1e-5);
    hit_error(20, 50, 0.5, DEM_LINEAR); /* momenta with friction */
}

/* A brick that falls on a plane, turned at random: restitution of its centre and scatter of its rebound. The angles are
   those of the spec's own program; so is the restitution at 0.29. Its dashpot acts on the mean mass at a corner, here
   it acts on the mass where it is hit, as the test after this one shows. */
static void test_rebound(void **state) {
    (void)state;
    const double table[5][4] = {
        {.29, .18, .10, 51}, {.50, .29, .14, 45}, {.65, .37, .16, 41}, {.75, .42, .18, 41}, {.90, .49, .21, 37}};
    for (int row = 0; row < 5; row++) {
        double sum = 0, squares = 0, angles = 0;
        const int n = 400;
        const double m = 2080.0, k = m / (0.01 * 0.01);
        seed = 3;
        for (int hit = 0; hit < n; hit++) {
            dem_world w;
            make(&w, RIDDLE_PI * sqrt(m / k) / 25, k, table[row][0], 0.8, 0.78, dem_vec3(0, 0, 0), 1);
            ground(&w);
            const int shape = brick(&w, 1.0, 1.0, 2.08, 0.005); /* as the spec's, whose corners are points */
            put(&w, shape, 0, 0, 1.3, random_bell(&seed), random_bell(&seed), random_bell(&seed), random_bell(&seed));
            dem_set_motion(&w, 0, dem_vec3(0, 0, -1), dem_vec3(0, 0, 0));
            do RUN(&w, 0.1);
            while (dem_position(&w, 0).z < 1.25 && w.time < 10.0);
            const dem_vec v = dem_velocity(&w, 0);
            const double angle = atan2(v.x, v.z) * 180 / RIDDLE_PI;
            sum += v.z / n, squares += v.z * v.z / n, angles += angle * angle / n;
            dem_free(&w);
        }
        const double scatter = sqrt(squares - sum * sum);
        print_message("brick on plane, e %.2f: %.3f +- %.3f (%.2f, %.2f), %.1f degrees (%.0f)\n", table[row][0], sum,
                      scatter, table[row][1], table[row][2], sqrt(angles), table[row][3]);
        near(sum, table[row][1], 0.03);
        near(scatter, table[row][2], 0.03);
        near(sqrt(angles), table[row][3], 3.0);
    }
}

/* A pile of bricks, another shape and spheres in a box; hashes at the end. */
static void fill_box(dem_world *w, int threads, int n) {
    const double tall[18] = {1e-3, 0, 0, -1e-3, 0, 0, 0, 1e-3, 0, 0, -1e-3, 0, 0, 0, 1.5e-3, 0, 0, -1.5e-3};
    dem_convex s;
    make(w, 2e-6, 8000.0, 0.5, 0.4, 0.8, dem_vec3(0, 0, -9.81), threads);
    assert_true(dem_add_box(w, 0, dem_vec3(-0.008, -0.008, 0), dem_vec3(0.008, 0.008, 0.1)) >= 0);
    assert_int_equal(dem_make_convex(&s, 6, tall, 0.05, NULL), DEM_OK);
    const int shapes[2] = {brick(w, 1e-3, 1e-3, 2e-3, 0.05), dem_add_shape(w, &s)};
    seed = 11;
    for (int k = 0; k < n; k++) {
        const double x = (k % 5 - 2) * 3e-3, y = (k / 5 % 5 - 2) * 3e-3, z = 2e-3 + k / 25 * 2.4e-3, d = 1.5e-3,
                     at[3] = {x, y, z};
        if (k % 7 == 3) assert_int_equal(dem_add_spheres(w, 1, at, &d, 0, 0), DEM_OK);
        else
            put(w, shapes[k % 2], x, y, z, random_bell(&seed), random_bell(&seed), random_bell(&seed),
                random_bell(&seed));
        dem_set_motion(w, k, dem_vec3(0, 0, -1), dem_vec3(0, 0, 0));
    }
}
static void test_pile(void **state) {
    (void)state;
    uint64_t hash[3];
    for (int run = 0; run < 3; run++) {
        dem_world w, again;
        fill_box(&w, run == 1 ? 2 : 1, 150);
        if (run == 2) {
            RUN(&w, 0.005);
            const size_t size = dem_save(&w, NULL, 0);
            unsigned char *bytes = malloc(size);
            assert_int_equal(dem_save(&w, bytes, size), size);
            assert_int_equal(dem_load(&again, bytes, size, NULL), DEM_OK);
            dem_free(&w);
            free(bytes);
            w = again;
            RUN(&w, 0.005);
        } else RUN(&w, 0.01);
        hash[run] = dem_hash(&w);
        assert_true(w.contact_steps > 5000);
        assert_int_equal(dem_core_overlaps(&w), 0);
        for (ptrdiff_t i = 0; i < w.count; i++) {
            const dem_vec x = dem_position(&w, i);
            assert_true(fabs(x.x) < 0.008 && fabs(x.y) < 0.008 && x.z > 0.0);
        }
        dem_free(&w);
    }
    assert_true(hash[0] == hash[1]);
    assert_true(hash[0] == hash[2]);
}

/* A sphere on a brick's face, and a brick on a sphere that is held: overlaps m g/k. The ledger adds up. */
static void test_spheres(void **state) {
    (void)state;
    dem_world w;
    const double at[3] = {0, 0, 0.0208 + 0.0025}, d = 0.005;
    make(&w, 1e-5, 1e4, 0.5, 0.5, 0.8, dem_vec3(0, 0, -9.81), 1);
    ground(&w);
    put(&w, brick(&w, 0.01, 0.01, 0.0208, 0.03), 0, 0, 0.0104, 1, 0, 0, 0);
    assert_int_equal(dem_add_spheres(&w, 1, at, &d, 0, 0), DEM_OK);
    assert_int_equal(dem_run(&w, 2.0, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY), DEM_OK);
    near(dem_position(&w, 0).z + 0.0104 + 0.0025 - dem_position(&w, 1).z, dem_mass(&w, 1) * 9.81 / 1e4, 1e-12);
    const dem_energy_ledger l = dem_energy(&w);
    assert_true(fabs(l.error) < 0.02 * l.released);
    dem_free(&w);
}

/* Feeds of polyhedra: as many as asked, or their mass, at rest nowhere within each other, turned in every
   direction alike. */
static void test_feed(void **state) {
    (void)state;
    dem_world w;
    make(&w, 1e-5, 1e4, 0.5, 0.5, 0.8, dem_vec3(0, 0, -9.81), 1);
    ground(&w);
    dem_feed feed = dem_default_feed();
    feed.region = dem_box_region(dem_vec3(0, 0, 0.0), dem_vec3(0.1, 0.1, 0.1));
    feed.velocity = dem_vec3(0, 0, -0.5);
    feed.polyhedron = 1;
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT); /* no shape yet */
    const int shape = brick(&w, 0.004, 0.004, 0.00832, 0.03);
    feed.polyhedron = shape + 1;
    assert_int_equal(dem_fill(&w, &feed, 300), DEM_OK);
    assert_int_equal(w.count, 300);
    assert_int_equal(feed.placed, 300);
    near(feed.placed_mass, 300 * dem_mass(&w, 0), 1e-12 * feed.placed_mass);
    near(dem_mass(&w, 0), 1000.0 * 0.004 * 0.004 * 0.00832, 1e-18);
    double along = 0.0;
    for (int i = 0; i < 300; i++) {
        assert_int_equal(dem_shape_of(&w, i), shape);
        const dem_vec axis = dem__to_lab(dem_orientation(&w, i), dem_vec3(0, 0, 1));
        along += axis.z * axis.z / 300;
        near(dem_velocity(&w, i).z, -0.5, 0.0);
    }
    near(along, 1.0 / 3.0, 0.06);
    RUN(&w, 1e-5);
    assert_int_equal(dem_contact_count(&w), 0);
    const double mass = dem_mass(&w, 0);
    feed.region = dem_box_region(dem_vec3(0, 0, 0.15), dem_vec3(0.1, 0.1, 0.15)); /* centres in a face */
    assert_int_equal(dem_feed_mass(&w, &feed, 20.0 * mass, 1.0), DEM_OK);
    assert_int_equal(w.count, 320);
    assert_int_equal(dem_feed_number(&w, &feed, 7.0, 1.0), DEM_OK);
    assert_int_equal(w.count, 327);
    RUN(&w, 0.02);
    feed.polyhedron = shape + 2;
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT);
    feed.polyhedron = -1;
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT);
    dem_clump clump;
    const double centre[3] = {0, 0, 0}, d = 1.0;
    assert_int_equal(dem_make_clump(1, centre, &d, &clump), DEM_OK);
    feed.polyhedron = 1, feed.clump = &clump;
    assert_int_equal(dem_fill(&w, &feed, 1), DEM_BAD_ARGUMENT);
    dem_free(&w);
}

/* A wall that does not act on a group lets its bricks pass, as it lets spheres pass. */
static void test_groups(void **state) {
    (void)state;
    dem_world w;
    make(&w, 1e-5, 1e4, 0.5, 0.5, 0.8, dem_vec3(0, 0, -9.81), 1);
    ground(&w);
    const int shape = brick(&w, 0.01, 0.01, 0.01, 0.03);
    for (int group = 0; group < 2; group++) {
        const double at[3] = {0.1 * group, 0, 0.0049};
        assert_int_equal(dem_add_convex(&w, shape, 1, at, NULL, 0, group), DEM_OK);
    }
    assert_int_equal(dem_set_wall_groups(&w, 0, 2u), DEM_OK);
    RUN(&w, 0.0);
    assert_int_equal(dem_contact_count(&w), 4); /* those of group 1 */
    RUN(&w, 0.2);
    near(dem_position(&w, 0).z, 0.0049 - 0.5 * 9.81 * w.time * w.time, 1e-9);
    assert_true(dem_position(&w, 1).z > 0.0);
    dem_free(&w);
}

/* In a funnel, where the curvature at a contact changes with its place: a world that is saved and loaded goes on with
   the same bits. So do its books, which pause in every second run. */
static void test_saved_in_a_funnel(void **state) {
    (void)state;
    const int features = DEM_HERTZ | DEM_FRICTION;
    dem_world w, twin;
    dem_cone cone = dem_default_cone();
    make(&w, 1e-5, 1e4, 0.5, 0.2, 0.8, dem_vec3(0, 0, -9.81), 1);
    cone.low_radius = 0.005, cone.high_radius = 0.1;
    assert_int_equal(dem_add_cone(&w, 0, &cone), 0);
    const int shape = brick(&w, 0.01, 0.012, 0.015, 0.1);
    put(&w, shape, 0.03, 0, 0.06, 1, 0.3, 0.2, 0), put(&w, shape, -0.03, 0, 0.06, 1, 0, 0.4, 0.3);
    int touched = 0;
    for (int k = 0; k < 40; k++) {
        const int also = k % 2 ? DEM_ENERGY : 0;
        assert_int_equal(dem_run(&w, 3e-3, features | also), DEM_OK);
        const size_t size = dem_save(&w, NULL, 0);
        void *bytes = malloc(size);
        assert_non_null(bytes);
        assert_int_equal(dem_save(&w, bytes, size), size);
        assert_int_equal(dem_load(&twin, bytes, size, NULL), DEM_OK);
        free(bytes);
        touched += dem_contact_count(&w) > 0;
        assert_int_equal(dem_run(&w, 3e-3, features | (DEM_ENERGY - also)), DEM_OK);
        assert_int_equal(dem_run(&twin, 3e-3, features | (DEM_ENERGY - also)), DEM_OK);
        assert_true(dem_hash(&w) == dem_hash(&twin));
        const dem_energy_ledger a = dem_energy(&w), b = dem_energy(&twin);
        assert_memory_equal(&a, &b, sizeof a);
        dem_free(&twin);
    }
    assert_true(touched > 4);
    dem_free(&w);
}

static void test_refused(void **state) {
    (void)state;
    dem_world w;
    dem_convex s;
    const double at[3] = {0, 0, 1}, bad[3] = {0, NAN, 0}, none[4] = {0, 0, 0, 0}, odd[4] = {1, 0, HUGE_VAL, 0};
    make(&w, 1e-5, 1e4, 0.5, 0.5, 0.8, dem_vec3(0, 0, 0), 1);
    assert_int_equal(dem_add_convex(&w, 0, 1, at, NULL, 0, 0), DEM_BAD_ARGUMENT); /* no such shape */
    memset(&s, 0, sizeof s);
    assert_int_equal(dem_add_shape(&w, &s), -(int)DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_shape(&w, NULL), -(int)DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_shape(NULL, &s), -(int)DEM_BAD_ARGUMENT);
    const int shape = brick(&w, 1, 1, 2, 0.03);
    assert_int_equal(dem_add_convex(&w, shape, 1, bad, NULL, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_convex(&w, shape, 1, at, none, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_convex(&w, shape, 1, at, odd, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_convex(&w, shape, 1, NULL, NULL, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_convex(&w, shape, 1, at, NULL, 1, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_convex(&w, shape, -1, at, NULL, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_add_convex(&w, shape + 1, 1, at, NULL, 0, 0), DEM_BAD_ARGUMENT);
    assert_int_equal(w.count, 0);
    assert_int_equal(dem_add_convex(&w, shape, 0, NULL, NULL, 0, 0), DEM_OK);
    assert_int_equal(dem_add_convex(&w, shape, 1, at, NULL, 0, 0), DEM_OK);
    assert_int_equal(dem_shape_of(&w, 0), shape);
    assert_int_equal(dem_shape_of(&w, 1), -1);
    assert_non_null(dem_get_shape(&w, shape));
    assert_null(dem_get_shape(&w, shape + 1));
    assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR), DEM_POLYHEDRON);
    assert_int_equal(dem_run(&w, 1e-3, DEM_HERTZ | DEM_FRICTION), DEM_OK);
    dem_free(&w);
}

/* An allocator that fails from the n-th call on. */
static int left;
static void *failing(void *user, void *old, size_t old_size, size_t new_size) {
    (void)user, (void)old_size;
    if (new_size == 0) {
        free(old);
        return NULL;
    }
    return left-- > 0 ? realloc(old, new_size) : NULL;
}
static void test_memory(void **state) {
    (void)state;
    int done = 0;
    for (int n = 0; !done && n < 200; n++) {
        dem_def def = dem_default_def();
        dem_world w;
        dem_convex s;
        const double at[6] = {0, 0, 1.04, 0, 0, 3.1};
        dem_add_material(&def, 1000.0, 1e7, 0.3);
        dem_pair(&def, 0, 0)->stiffness = 1e8;
        def.dt = 1e-4;
        def.allocator.fn = failing;
        left = n;
        assert_int_equal(dem_make_brick(&s, dem_vec3(1, 1, 2.08), 0.03, NULL), DEM_OK);
        if (dem_init(&w, &def, NULL) != DEM_OK) continue;
        const int wall = dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)), shape = dem_add_shape(&w, &s);
        assert_true(shape == 0 || shape == -(int)DEM_OUT_OF_MEMORY);
        const dem_status added = shape == 0 ? dem_add_convex(&w, shape, 2, at, NULL, 0, 0) : DEM_OUT_OF_MEMORY;
        const dem_status ran = dem_run(&w, 0.1, DEM_LINEAR | DEM_FRICTION);
        assert_true(ran == DEM_OK || ran == DEM_OUT_OF_MEMORY);
        done = wall == 0 && added == DEM_OK && ran == DEM_OK;
        dem_free(&w);
    }
    assert_true(done);
}

/* Corners of the core of body 0, where the engine has them, are where a rotation q from the given frame puts them. */
static void lies_by(const dem_world *w, const dem_convex *s, dem_quaternion q) {
    const dem__rigid *r = dem__rigid_of(w, 0);
    const dem__pose p = dem__pose_at(w, r, dem__now(w, 0));
    const dem_quaternion own = dem__turns(p.turn, dem__opposite_turn(r->frame)), told = dem_orientation(w, 0);
    const dem_quaternion of = dem_get_body(w, 0).orientation;
    const dem_convex *kept = dem_get_shape(w, 0);
    for (int k = 0; k < s->corners; k++) {
        const dem_vec along = dem__point(kept->corner[k]), given = dem__point(s->corner[k]);
        assert_true(dem__length(dem__sub(dem__to_lab(own, along), dem__to_lab(q, given))) <
                    1e-14 * (1.0 + s->reach / 1e-3));
    }
    for (int f = 0; f < s->faces; f++) {
        const dem_vec along = dem__point(kept->plane[f]), given = dem__point(s->plane[f]);
        assert_true(dem__length(dem__sub(dem__to_lab(own, along), dem__to_lab(q, given))) < 1e-14);
    }
    assert_true(fabs(fabs(told.w * q.w + told.x * q.x + told.y * q.y + told.z * q.z) - 1.0) < 1e-14);
    assert_true(of.w == told.w && of.x == told.x && of.y == told.y && of.z == told.z);
}

/* Orientations are from the frame in which a shape was given, as for clumps; without any, it lies as it was given: a
   wedge on its face. */
static void test_as_given(void **state) {
    (void)state;
    uint64_t random = 7;
    int cases = 0, largest[4] = {0, 0, 0, 0};
    for (int k = 0; k < 300; k++) {
        double corner[6][3] = {{0, 0, 0}, {3e-3, 0, 0}, {0, 1e-3, 0}, {3e-3, 1e-3, 0}, {0, 0, 2e-3}, {0, 1e-3, 2e-3}},
               v[8];
        for (int n = 0; n < 12 && k > 0; n++) corner[n / 3][n % 3] = 4e-3 * random_plain(&random);
        for (int n = 0; n < 8; n++) v[n] = random_plain(&random) - 0.5;
        dem_convex s;
        if (dem_make_convex(&s, k > 0 ? 4 : 6, corner[0], 0.03, NULL) != DEM_OK) continue; /* too flat */
        for (int n = 0; n < (k > 0 ? 4 : 6); n++) { /* the given corners touch its faces: planes are as given */
            double highest = -HUGE_VAL;
            for (int f = 0; f < s.faces; f++)
                highest = fmax(highest, dem__dot(dem__point(s.plane[f]), dem__sub(dem__point(corner[n]), s.centroid)) -
                                            s.plane[f][3]);
            assert_true(fabs(highest - s.radius) < 1e-12 * s.reach);
        }
        dem_def def = dem_default_def();
        dem_world w;
        dem_add_material(&def, 2500.0, 1e9, 0.2);
        def.dt = 1e-6, dem_pair(&def, 0, 0)->stiffness = 1e4;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        const int shape = dem_add_shape(&w, &s);
        const int again = dem_add_shape(&w, dem_get_shape(&w, shape)); /* the world's copy is not turned again */
        assert_memory_equal(dem_get_shape(&w, again)->corner, dem_get_shape(&w, shape)->corner, sizeof s.corner);
        assert_memory_equal(dem_get_shape(&w, again)->plane, dem_get_shape(&w, shape)->plane, sizeof s.plane);
        const double at[3] = {0, 0, s.centroid.z - 1e-9};
        const dem_quaternion one = {1, 0, 0, 0}, any = {v[4], v[5], v[6], v[7]};
        dem_quaternion q, other;
        assert_true(dem__unit_turn(dem__quaternion(v[0], dem_vec3(v[1], v[2], v[3])), &q) &&
                    dem__unit_turn(any, &other));
        if (k == 0) {
            assert_true(dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) >= 0);
            assert_int_equal(dem_add_convex(&w, shape, 1, at, NULL, 0, 0), DEM_OK);
            lies_by(&w, &s, one);
            assert_int_equal(dem_run(&w, 1e-6, DEM_LINEAR | DEM_FRICTION), DEM_OK);
            assert_int_equal(dem_contact_count(&w), 4); /* flat on its four corners */
        } else {
            assert_int_equal(dem_add_convex(&w, shape, 1, at, k % 2 ? v : NULL, 0, 0), DEM_OK);
            lies_by(&w, &s, k % 2 ? q : one);
            assert_int_equal(dem_set_orientation(&w, 0, any), DEM_OK);
            lies_by(&w, &s, other);
            assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0, 0, 0), dem_vec3(300, -200, 500)), DEM_OK);
            assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR | DEM_FRICTION), DEM_OK);
            lies_by(&w, &s, dem_orientation(&w, 0));
            const dem_quaternion now = dem_orientation(&w, 0);
            assert_true(fabs(now.w * other.w + now.x * other.x + now.y * other.y + now.z * other.z) < 1.0 - 1e-3);
        }
        s.axis[0] = dem__first_axis(q), s.axis[1] = dem__second_axis(q),
        s.axis[2] = dem__third_axis(q); /* any axes, as a host may set */
        const dem_quaternion turned = dem__turn_of_shape(&s);
        assert_true(fabs(fabs(turned.w * q.w + turned.x * q.x + turned.y * q.y + turned.z * q.z) - 1.0) < 1e-14);
        const double four[4] = {fabs(turned.w), fabs(turned.x), fabs(turned.y), fabs(turned.z)};
        int most = 0;
        for (int n = 1; n < 4; n++) most = four[n] > four[most] ? n : most;
        largest[most]++, cases++;
        dem_free(&w);
    }
    print_message("%d shapes; largest of the numbers of their rotations: w %d, x %d, y %d, z %d\n", cases, largest[0],
                  largest[1], largest[2], largest[3]);
    assert_true(cases > 200 && largest[0] > 20 && largest[1] > 20 && largest[2] > 20 && largest[3] > 20);
}

/* ---- faces, edges and corners that land ---- */

/* An upright prism of 1 mm across and half as high. */
static int prism(dem_world *w, int sides) {
    double corner[32][3];
    dem_convex s;
    for (int k = 0; k < 2 * sides; k++) {
        const double turn = 2.0 * RIDDLE_PI * (k / 2) / sides + 0.1;
        corner[k][0] = 5e-4 * cos(turn), corner[k][1] = 5e-4 * sin(turn), corner[k][2] = k % 2 ? 2.5e-4 : -2.5e-4;
    }
    assert_int_equal(dem_make_convex(&s, 2 * sides, corner[0], 0.03, NULL), DEM_OK);
    return dem_add_shape(w, &s);
}

/* What a prism lands on, and how: on a face, an edge and a corner. */
enum { ON_PLANE, ON_BOX, ON_CYLINDER, ON_SLAB, GROUNDS };
enum { FLAT, ON_EDGE, ON_CORNER, LANDINGS };

/* Returns the restitution at the point where a prism hits, without friction. */
static double landing(int sides, int where, int way, double e, double k, double speed, double density, int law) {
    dem_world w;
    dem_def def = dem_default_def();
    double low = 1.0, most = 0.0, x[3] = {0, 0, 0}, q[4] = {1, 0, 0, 0};
    dem_vec arm = dem_vec3(0, 0, 0), along = dem_vec3(0, 0, 1); /* of the resultant when it is greatest */
    dem_add_material(&def, density, 1e7, 0.3);
    dem_pair_def *pair = dem_pair(&def, 0, 0);
    pair->stiffness = k, pair->restitution = e, pair->friction = 0.0;
    def.gravity = dem_vec3(0, 0, 0);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    const int shape = prism(&w, sides);
    const dem_convex *s = dem_get_shape(&w, shape);
    if (way == ON_EDGE) { /* about an edge of the cap */
        const double turn = 0.1 + RIDDLE_PI / sides + RIDDLE_PI / 2;
        q[0] = cos(0.3), q[1] = sin(0.3) * cos(turn), q[2] = sin(0.3) * sin(turn);
    }
    if (way == ON_CORNER) q[0] = 1.0, q[1] = 0.35, q[2] = 0.21, q[3] = 0.1;
    assert_int_equal(dem_add_convex(&w, shape, 1, x, q, 0, 0), DEM_OK);
    const dem_quaternion turn = dem_orientation(&w, 0);
    dem__placed place;
    for (int a = 0; a < 3; a++) { /* the shape's own axes in the world */
        const dem_vec u = s->axis[a], one = dem__scale(u.x, dem__first_axis(turn)),
                      two = dem__scale(u.y, dem__second_axis(turn));
        place.axis[a] = dem__add(dem__add(one, two), dem__scale(u.z, dem__third_axis(turn)));
    }
    for (int c = 0; c < s->corners; c++) {
        const double z = dem__dot(dem__from_core_frame(&place, dem__point(s->corner[c])), dem_vec3(0, 0, 1));
        low = z < low ? z : low;
    }
    const double ground_z = low - s->radius - 1e-7;
    if (where == ON_PLANE) dem_add_plane(&w, 0, dem_vec3(0, 0, ground_z), dem_vec3(0, 0, 1));
    else if (where == ON_BOX)
        dem_add_box(&w, 0, dem_vec3(-2e-3, -2.1e-3, ground_z - 1e-3), dem_vec3(2.2e-3, 2e-3, ground_z));
    else if (where == ON_CYLINDER) dem_add_cylinder(&w, 0, dem_vec3(0, 0, ground_z - 0.05), dem_vec3(1, 0, 0), 0.05, 0);
    else {
        const int slab = brick(&w, 5e-3, 5.2e-3, 1e-3, 0.03);
        put(&w, slab, 1e-4, 2e-4, ground_z - 5e-4, 1, 0, 0, 0.1);
        assert_int_equal(dem_fix(&w, 1, 1), DEM_OK);
    }
    assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0, 0, -speed), dem_vec3(0, 0, 0)), DEM_OK);
    dem_set_time_step(&w, dem_advise(&w, law | DEM_FRICTION, speed).advised / 4.0);
    do {
        assert_int_equal(dem_run(&w, 1e-6, law | DEM_FRICTION), DEM_OK);
        const dem_vec x0 = dem_position(&w, 0);
        dem_vec force = dem_vec3(0, 0, 0), sum = dem_vec3(0, 0, 0);
        double total = 0.0;
        for (ptrdiff_t c = 0; c < dem_contact_count(&w); c++) {
            const dem_contact_info at = dem_get_contact(&w, c);
            const double push = fabs(dem__dot(at.force, at.normal));
            force = dem__add(force, at.force), total += push;
            sum = dem__plus(sum, push, dem__sub(at.point, x0));
        }
        if (dem__length(force) > most)
            most = dem__length(force), along = dem__scale(1.0 / most, force), arm = dem__scale(1.0 / total, sum);
    } while ((dem_contact_count(&w) > 0 || most == 0.0) && w.time < 0.1);
    const dem_vec v = dem_velocity(&w, 0), spin = dem_spin(&w, 0);
    dem_free(&w);
    return dem__dot(dem__add(v, dem__cross(spin, arm)), along) / (speed * fabs(along.z));
}

/* A face, an edge and a corner rebound with what was asked, however many corners a face has, from walls and bodies,
   by both laws. */
static void test_landings(void **state) {
    (void)state;
    static const char *const on[GROUNDS] = {"plane", "box", "cylinder", "fixed slab"}, *const as[LANDINGS] = {
                                                                                           "face", "edge", "corner"};
    for (int where = 0; where < GROUNDS; where++) {
        for (int way = 0; way < LANDINGS; way++) {
            if (where == ON_CYLINDER && way != FLAT) continue; /* points touch one after the other */
            double worst = 0.0;
            for (int k = 0; k < 9; k++) {
                const int sides = 4 << k % 3, law = k % 2 ? DEM_HERTZ : DEM_LINEAR;
                const double e = 0.1 + 0.1 * k, stiffness = k % 4 ? 2e4 : 3e3, speed = k % 5 ? 0.02 : 0.05,
                             density = k % 3 ? 2500 : 900;
                /* Overlaps are too deep; radii differ. */
                if (law == DEM_HERTZ && (way != FLAT || where == ON_CYLINDER)) continue;
                const double got = landing(sides, where, way, e, stiffness, speed, density, law);
                worst = fmax(worst, fabs(got - e));
                if (!(fabs(got - e) < 0.02))
                    print_message("  %d sides, law %d: asked %.1f, got %.3f\n", sides, law, e, got);
            }
            print_message("%s on %s: restitution at the point is that asked to %.4f\n", as[way], on[where], worst);
            assert_true(worst < 0.02);
        }
    }
}

/* Without losses a prism tumbles between six walls, and keeps its energy, however many corners it has. */
static void test_tumble(void **state) {
    (void)state;
    for (int sides = 3; sides <= 16; sides = sides == 3 ? 4 : 2 * sides) {
        dem_world w;
        const double x[3] = {0, 0, 0}, d = 1.2e-3;
        make(&w, 1e-6, 100.0, 1.0, 0.0, 0.8, dem_vec3(0, 0, 0), 1);
        assert_int_equal(dem_add_convex(&w, prism(&w, sides), 1, x, NULL, 0, 0), DEM_OK);
        for (int k = 0; k < 6; k++) {
            const double to = k % 2 ? -1.0 : 1.0;
            const dem_vec n = dem_vec3(k / 2 == 0 ? to : 0, k / 2 == 1 ? to : 0, k / 2 == 2 ? to : 0);
            assert_true(dem_add_plane(&w, 0, dem_vec3(-d * n.x, -d * n.y, -d * n.z), n) >= 0);
        }
        assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0.02, -0.013, 0.03), dem_vec3(20, -30, 10)), DEM_OK);
        dem_set_time_step(&w, 0.5 * dem_advise(&w, DEM_LINEAR, 0.04).advised);
        const double before = energy(&w);
        double worst = 0.0;
        int64_t steps = 0;
        for (int k = 0; k < 4; k++) {
            RUN(&w, 0.04);
            steps = w.contact_steps;
            if (dem_contact_count(&w) == 0) worst = fmax(worst, fabs(energy(&w) / before - 1.0));
        }
        print_message("%d sides: energy within %.1e after 0.16 s, %ld steps of contacts\n", sides, worst, (long)steps);
        assert_true(worst < 1e-3 && steps > 1000);
        dem_free(&w);
    }
}

/* Tablets that lie on each other come to rest at the advised step. */
static void test_stack_of_tablets(void **state) {
    (void)state;
    for (int sides = 4; sides <= 16; sides *= 2) {
        dem_world w;
        enum { N = 3 };
        const double h = 5e-4;
        double x[3 * N], q[4 * N];
        make(&w, 1e-6, 100.0, 0.3, 0.5, 0.8, dem_vec3(0, 0, -9.81), 1);
        dem_pair_def damped = *dem_pair(&w.def, 0, 0);
        damped.tangential_damping = 1.0; /* without it what they swing sideways below the limit of friction stays */
        assert_int_equal(dem_set_pair(&w, 0, 0, &damped), DEM_OK);
        const int shape = prism(&w, sides);
        for (int k = 0; k < N; k++) {
            const double turn = 0.1 * k;
            x[3 * k] = 1e-5 * k, x[3 * k + 1] = -2e-5 * k, x[3 * k + 2] = h * (k + 0.5);
            q[4 * k] = cos(turn), q[4 * k + 1] = q[4 * k + 2] = 0.0, q[4 * k + 3] = sin(turn);
        }
        assert_int_equal(dem_add_convex(&w, shape, N, x, q, 0, 0), DEM_OK);
        ground(&w);
        const double scale = dem_mass(&w, 0) * 9.81 * h;
        dem_set_time_step(&w, dem_advise(&w, DEM_LINEAR, 0.1).advised);
        assert_int_equal(dem_run(&w, 0.03, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY), DEM_OK);
        const double open = dem_energy(&w).error;
        assert_int_equal(dem_run(&w, 0.03, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY), DEM_OK);
        print_message("%d sides: kinetic %.1e m g h, energy open by %.1e m g h a second\n", sides, energy(&w) / scale,
                      (dem_energy(&w).error - open) / 0.03 / scale);
        assert_true(energy(&w) < 1e-12 * scale && fabs(dem_energy(&w).error - open) < 0.03 * 1e-6 * scale);
        dem_free(&w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rest),
        cmocka_unit_test(test_failed_step_turns_nothing),
        cmocka_unit_test(test_contacts_read),
        cmocka_unit_test(test_slide),
        cmocka_unit_test(test_tip),
        cmocka_unit_test(test_rock),
        cmocka_unit_test(test_hits),
        cmocka_unit_test(test_rebound),
        cmocka_unit_test(test_landings),
        cmocka_unit_test(test_tumble),
        cmocka_unit_test(test_stack_of_tablets),
        cmocka_unit_test(test_pile),
        cmocka_unit_test(test_spheres),
        cmocka_unit_test(test_feed),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_memory),
        cmocka_unit_test(test_groups),
        cmocka_unit_test(test_saved_in_a_funnel),
        cmocka_unit_test(test_as_given),
    };
    if (getenv("RIDDLE_TEST")) cmocka_set_test_filter(getenv("RIDDLE_TEST"));
    return cmocka_run_group_tests(tests, NULL, NULL);
}
