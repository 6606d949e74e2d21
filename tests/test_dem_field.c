/* Force fields and gas of dem.h: flights by steps of their own, drag, the gas that turns with the walls. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "dem.h"

#include "failing_allocator.h"
#include "../examples/common/random.h"

DEM_GAS(stokes, dem_drag_stokes)
DEM_GAS(schiller, dem_drag_schiller_naumann)
DEM_GAS(hoelzer, dem_drag_hoelzer_sommerfeld)

static const double eta = 1.81e-5, density = 2700.0;

static dem_def grains(double dt) {
    dem_def def = dem_default_def();
    dem_add_material(&def, density, 1e9, 0.3);
    dem_pair(&def, 0, 0)->stiffness = 200.0;
    dem_pair(&def, 0, 0)->restitution = 0.5;
    def.dt = dt;
    return def;
}
static void add(dem_world *w, double x, double y, double z, double d, dem_vec v) {
    const double centre[3] = {x, y, z};
    assert_int_equal(dem_add_spheres(w, 1, centre, &d, 0, 0), DEM_OK);
    assert_int_equal(dem_set_motion(w, w->count - 1, v, dem_vec3(0, 0, 0)), DEM_OK);
}

/* Relaxation to the terminal velocity by Stokes's law, in closed form. */
static void relaxation(void **state) {
    (void)state;
    const double d = 20e-6, tau = density * d * d / 18.0 / eta;
    dem_gas air = dem_default_gas();
    dem_force_field f = dem_gas_field(stokes, &air);
    dem_def def = grains(1e-7);
    for (int run = 0; run < 3; run++) {
        dem_world w;
        f.accuracy = run == 1 ? 1e-9 : 1e-6;
        air.buoyancy = run == 2;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        add(&w, 0, 0, 0, d, dem_vec3(3.0, 0, 0));
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        const double g = -9.81 * (air.buoyancy ? 1.0 - air.density / density : 1.0);
        for (int k = 0; k < 8; k++) {
            assert_int_equal(dem_run(&w, 0.5 * tau, DEM_LINEAR), DEM_OK);
            const double t = w.time, e = exp(-t / tau);
            const dem_vec x = dem_position(&w, 0), v = dem_velocity(&w, 0);
            const double off = run == 1 ? 2e-11 : 2e-8;
            assert_true(fabs(x.x / (3.0 * tau * (1 - e)) - 1) < off &&
                        fabs(x.z / (g * tau * (t - tau * (1 - e))) - 1) < off);
            assert_true(fabs(v.x / (3.0 * e) - 1.0) < off && fabs(v.z / (g * tau * (1 - e)) - 1.0) < off);
        }
        dem_free(&w);
    }
}

/* A box with spheres of three sizes, stirred by a turning paddle; what flies in it. */
static int stirred(dem_world *w, int skip, int threads, int balls) {
    dem_def def = grains(2e-8);
    uint64_t random = 7;
    def.skip = skip, def.threads = threads;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
    w->def.skip = skip;
    assert_true(dem_add_plane(w, 0, dem_vec3(0, 0, -5e-4), dem_vec3(0, 0, 1)) >= 0);
    assert_true(dem_add_plane(w, 0, dem_vec3(0, 0, 5e-4), dem_vec3(0, 0, -1)) >= 0);
    assert_true(dem_add_cylinder(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 2e-3, 1) >= 0);
    const int paddle = dem_add_box(w, 0, dem_vec3(-1.5e-3, -5e-5, -6e-4), dem_vec3(1.5e-3, 5e-5, 6e-4));
    assert_true(paddle >= 0);
    assert_int_equal(dem_rotate(w, paddle, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), 600.0), DEM_OK);
    dem_feed feed = dem_default_feed();
    const double size[3] = {20e-6, 40e-6, 60e-6}, share[3] = {1, 1, 1};
    feed.sizes = dem_size_list(3, size, share, 0);
    feed.region = dem_box_region(dem_vec3(-1.3e-3, -1.3e-3, -4e-4), dem_vec3(1.3e-3, 1.3e-3, 4e-4));
    feed.scatter = dem_vec3(2, 2, 2);
    feed.random = random;
    assert_int_equal(dem_fill(w, &feed, balls), DEM_OK);
    return paddle;
}
static void say(const dem_world *w, const char *name) {
    if (getenv("SAY"))
        printf("%s: step %lld hash %016llx contacts %td contact steps %lld looks %lld rebuilds %lld %s\n", name,
               (long long)w->step, (unsigned long long)dem_hash(w), dem_contact_count(w), (long long)w->contact_steps,
               (long long)w->looks, (long long)w->rebuilds, dem_status_text(w->status));
}

/* Skipping changes no bit in a field; neither do threads. */
static void skipping_is_exact(void **state) {
    (void)state;
    uint64_t hash[5];
    static const int skips[] = {DEM_SKIP_ALL, 0, DEM_SKIP_PAIRS, DEM_SKIP_SPACE, DEM_SKIP_ALL};
    for (int run = 0; run < 5; run++) {
        dem_world w;
        dem_gas air = dem_default_gas();
        const int paddle = stirred(&w, skips[run], run == 4 ? 3 : 1, 300);
        assert_int_equal(dem_attach_gas(&air, &w, paddle), DEM_OK);
        dem_force_field f = dem_gas_field(schiller, &air);
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        assert_int_equal(dem_run(&w, 4e-4, DEM_LINEAR | DEM_FRICTION), DEM_OK);
        assert_true(w.contact_steps > 1000);
        hash[run] = dem_hash(&w);
        say(&w, "stirred");
        dem_free(&w);
    }
    for (int run = 1; run < 5; run++) assert_true(hash[run] == hash[0]);
}

static dem_vec nothing(const dem_force_point *at) {
    (void)at;
    return dem_vec3(0, 0, 0);
}
DEM_FORCE_FIELD(nothing_field, nothing)

/* A field that is 0 leaves every bit as it is. */
static void no_field_no_change(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int run = 0; run < 2; run++) {
        dem_world w;
        stirred(&w, DEM_SKIP_ALL, 1, 300);
        dem_force_field f = dem_default_force_field(nothing_field, NULL);
        f.length = 1e-4;
        if (run) assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        assert_int_equal(dem_run(&w, 4e-4, DEM_LINEAR | DEM_FRICTION), DEM_OK);
        assert_true(w.contact_steps > 1000);
        hash[run] = dem_hash(&w);
        say(&w, "nothing");
        dem_free(&w);
    }
    assert_true(hash[1] == hash[0]);
}

/* ---- a particle that a turning paddle meets ---- */

enum { NODES = 9 };
static const double r_a = 25e-3, omega = 9000.0 * RIDDLE_PI / 30.0, thickness = 2e-3, phase = 0.22, inward = 2.8,
                    speck = 30e-6;

typedef struct hit {
    int n;
    double radius, radial; /* at the face of a paddle as thick as that of a point's answer [m], along the face
                              against it [m/s] */
} hit;

/* At a contact's beginning: back along the straight line of the last step to where the face was met. */
static void note_hit(dem_world *w, const int32_t *slots, ptrdiff_t n, void *user) {
    hit *h = (hit *)user;
    (void)slots, (void)n;
    if (h->n++) return;
    const double end = w->time + w->def.dt;
    const dem_vec p = w->particle[0].x, a = w->particle[0].a, last = dem__plus(w->particle[0].v, 0.5 * w->def.dt, a);
    double late = 0.0;
    for (int tries = 0; tries < 5; tries++) {
        const dem_vec v = dem__plus(last, -late, a);
        const double s = sin(omega * (end - late)), c = cos(omega * (end - late)), x = p.x - late * v.x,
                     y = p.y - late * v.y;
        const double across = c * y - s * x, along = c * x + s * y, speed = c * v.y - s * v.x - omega * along;
        h->radius = hypot(x, y);
        h->radial = c * v.x + s * v.y + omega * across;
        late -= (0.5 * thickness - across) / speed;
    }
}
static const dem_law linear_noting = {"linear, noting", 1,        0,   0, 0, DEM_LINEAR_CONSTANTS, dem_prepare_linear,
                                      dem_force_linear, note_hit, NULL};
DEM_KERNEL(noting, linear_noting, DEM_LINEAR)

/* Gas seen from the wheel, at the nodes of a grid around the gap: inward as the passage narrows, and a swirl
   over the depth. */
static void fill_grid(dem_gas *gas, double *velocity) {
    gas->low = dem_vec3(17e-3, -6e-3, -1e-3), gas->high = dem_vec3(26e-3, 9e-3, 1e-3);
    gas->n[0] = NODES, gas->n[1] = NODES + 1, gas->n[2] = 3;
    for (int z = 0; z < 3; z++) {
        for (int y = 0; y < NODES + 1; y++) {
            for (int x = 0; x < NODES; x++) {
                const double px = 17e-3 + 9e-3 * x / (NODES - 1), py = -6e-3 + 15e-3 * y / NODES, r = hypot(px, py);
                double *u = velocity + 3 * ((z * (NODES + 1) + y) * NODES + x);
                const double in = 7.1 * r_a / r, swirl = 3.0 * sin(300.0 * px);
                u[0] = (-in * px - swirl * py) / r, u[1] = (-in * py + swirl * px) / r, u[2] = 0.1 * (z - 1);
            }
        }
    }
    gas->velocity = velocity;
}

/* The test's own: trilinear, in the plane z = 0, in the turning frame. */
static void gas_there(const double *velocity, const double *x, double *u) {
    const double fx = (x[0] - 17e-3) / 9e-3 * (NODES - 1), fy = (x[1] + 6e-3) / 15e-3 * NODES;
    const int kx = (int)floor(fx), ky = (int)floor(fy);
    const double *at = velocity + 3 * ((NODES + 1 + ky) * NODES + kx), a = fx - kx, b = fy - ky;
    for (int k = 0; k < 2; k++)
        u[k] =
            (1 - b) * ((1 - a) * at[k] + a * at[3 + k]) + b * ((1 - a) * at[3 * NODES + k] + a * at[3 * NODES + 3 + k]);
}
/* Acceleration in the turning frame: drag by Schiller & Naumann, centrifugal, Coriolis. */
static void pull_there(const double *velocity, const double *s, double *a) {
    double u[2] = {0.0, 0.0}, drag = 0.0;
    if (velocity) {
        gas_there(velocity, s, u);
        u[0] -= s[2], u[1] -= s[3];
        const double re = 1.2 * hypot(u[0], u[1]) * speck / eta;
        drag = 18.0 * eta / (density * speck * speck) * (1.0 + 0.15 * pow(re, 0.687));
    }
    a[0] = drag * u[0] + omega * omega * s[0] + 2.0 * omega * s[3];
    a[1] = drag * u[1] + omega * omega * s[1] - 2.0 * omega * s[2];
}
static void rates(const double *velocity, const double *s, double *k) {
    k[0] = s[2], k[1] = s[3];
    pull_there(velocity, s, k + 2);
}
/* From the entry to the face at y = thickness/2, by RK4 with the last step cut by Newton. */
static hit own_answer(const double *velocity) {
    double s[4] = {r_a * cos(phase), r_a * sin(phase), -inward * cos(phase) + omega * r_a * sin(phase),
                   -inward * sin(phase) - omega * r_a * cos(phase)};
    double h = 1e-8;
    for (int tries = 0; tries < 200000 && fabs(s[1] - 0.5 * thickness) > 1e-17; tries++) {
        double k[4][4], q[4];
        if (s[1] + 2.0 * h * s[3] < 0.5 * thickness || h < 1e-8) h = (0.5 * thickness - s[1]) / s[3];
        rates(velocity, s, k[0]);
        for (int stage = 1; stage < 4; stage++) {
            for (int c = 0; c < 4; c++) q[c] = s[c] + h * (stage == 3 ? 1.0 : 0.5) * k[stage - 1][c];
            rates(velocity, q, k[stage]);
        }
        for (int c = 0; c < 4; c++) s[c] += h / 6.0 * (k[0][c] + 2.0 * k[1][c] + 2.0 * k[2][c] + k[3][c]);
        if (h < 1e-8 && fabs(s[1] - 0.5 * thickness) < 1e-14) break;
    }
    hit a = {1, hypot(s[0], s[1]), s[2]};
    return a;
}
static hit in_the_gap(int with_gas, const double *velocity, double accuracy) {
    hit h = {0, 0, 0};
    dem_world w;
    dem_def def = grains(2e-9);
    dem_gas air = dem_default_gas();
    def.gravity = dem_vec3(0, 0, 0);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    w.user = &h;
    const double half = 0.5 * thickness - 0.5 * speck;
    const int paddle = dem_add_box(&w, 0, dem_vec3(18e-3, -half, -1e-3), dem_vec3(26e-3, half, 1e-3));
    assert_true(paddle >= 0);
    assert_int_equal(dem_rotate(&w, paddle, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), omega), DEM_OK);
    add(&w, r_a * cos(phase), r_a * sin(phase), 0.0, speck, dem_vec3(-inward * cos(phase), -inward * sin(phase), 0));
    memcpy(&air.velocity, &velocity, sizeof velocity);
    if (with_gas) {
        air.low = dem_vec3(17e-3, -6e-3, -1e-3), air.high = dem_vec3(26e-3, 9e-3, 1e-3);
        air.n[0] = NODES, air.n[1] = NODES + 1, air.n[2] = 3;
        assert_int_equal(dem_attach_gas(&air, &w, paddle), DEM_OK);
        assert_int_equal(dem_check_gas(&air, NULL), DEM_OK);
        dem_force_field f = dem_gas_field(schiller, &air);
        f.accuracy = accuracy;
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
    }
    for (int k = 0; k < 300 && h.n == 0; k++) assert_int_equal(dem_run_law(&w, 1e-6, &noting), DEM_OK);
    assert_int_equal(h.n > 0, 1);
    dem_free(&w);
    return h;
}

/* Spec 1.8: without gas 24.468 mm and -1.855 m/s; with gas that turns with the wheel, what one finds in the
   turning frame. */
static void turning_frame(void **state) {
    (void)state;
    static double velocity[3 * NODES * (NODES + 1) * 3];
    dem_gas air = dem_default_gas();
    fill_grid(&air, velocity);
    const hit free_own = own_answer(NULL), own = own_answer(velocity), bare = in_the_gap(0, NULL, 0.0);
    if (getenv("SAY"))
        printf("no gas: %.9f mm %.9f m/s, own %.9f %.9f\n", 1e3 * bare.radius, bare.radial, 1e3 * free_own.radius,
               free_own.radial);
    assert_true(fabs(bare.radius - 24.468e-3) < 5e-7 && fabs(bare.radial + 1.855) < 5e-4);
    assert_true(fabs(bare.radius / free_own.radius - 1.0) < 1e-9 && fabs(bare.radial / free_own.radial - 1.0) < 1e-9);
    for (int run = 0; run < 3; run++) {
        const double accuracy = run == 0 ? 1e-4 : run == 1 ? 1e-6 : 1e-10;
        const hit h = in_the_gap(1, velocity, accuracy);
        if (getenv("SAY"))
            printf("gas %.0e: %.9f mm %.9f m/s, off %.2e %.2e\n", accuracy, 1e3 * h.radius, h.radial,
                   h.radius / own.radius - 1.0, h.radial / own.radial - 1.0);
        assert_true(fabs(h.radius / own.radius - 1.0) < (run ? 1e-9 : 1e-7) &&
                    fabs(h.radial / own.radial - 1.0) < (run == 2 ? 1e-9 : 1e-7));
    }
}

/* Fall from rest by Schiller & Naumann's law to 99.9 % of the terminal velocity, against small steps of RK4. */
static void schiller_naumann(void **state) {
    (void)state;
    const double d = 200e-6;
    dem_gas air = dem_default_gas();
    dem_force_field f = dem_gas_field(schiller, &air);
    dem_def def = grains(1e-5);
    dem_world w;
    f.accuracy = 1e-8;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    add(&w, 0, 0, 0, d, dem_vec3(0, 0, 0));
    assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
    double v = 0.0, z = 0.0;
    const double h = 2e-5, k = 18.0 * eta / density / d / d;
    for (int step = 0; step < 100000; step++) {
        double a[4], u[4] = {v, 0, 0, 0};
        for (int s = 0; s < 4; s++) {
            if (s) u[s] = v + h * (s == 3 ? 1.0 : 0.5) * a[s - 1];
            a[s] = 9.81 - k * u[s] * (1.0 + 0.15 * pow(1.2 * fabs(u[s]) * d / eta, 0.687));
        }
        z += h / 6.0 * (u[0] + 2 * u[1] + 2 * u[2] + u[3]), v += h / 6.0 * (a[0] + 2 * a[1] + 2 * a[2] + a[3]);
    }
    assert_int_equal(dem_run(&w, 2.0, DEM_LINEAR), DEM_OK);
    assert_true(fabs(-dem_velocity(&w, 0).z / v - 1.0) < 1e-8 && fabs(-dem_position(&w, 0).z / z - 1.0) < 1e-8);
    const double balance = 9.81 / k / (1.0 + 0.15 * pow(1.2 * v * d / eta, 0.687));
    assert_true(fabs(v / balance - 1.0) < 1e-6); /* it is the terminal velocity by now */
    dem_free(&w);
}

/* The laws at the values of the specification. */
static void laws(void **state) {
    (void)state;
    dem_gas gas = dem_default_gas();
    assert_true(fabs(dem_drag_hoelzer_sommerfeld(1.0, 1.0, &gas) - 27.42) < 1e-12);
    assert_true(fabs(dem_drag_hoelzer_sommerfeld(100.0, 1.0, &gas) / 100.0 - 0.96) < 1e-12);
    dem_shape_of_drag(0.85, 0.85, 0.85, gas.shape);
    assert_true(fabs(dem_drag_hoelzer_sommerfeld(50.0, 1.0, &gas) / 50.0 / 1.849515746627166 - 1.0) < 1e-13);
    dem_shape_of_drag(0.7, 0.7, 0.7, gas.shape);
    assert_true(fabs(dem_drag_hoelzer_sommerfeld(0.01, 1.0, &gas) / 0.01 / 2908.881123028879 - 1.0) < 1e-13);
    dem_shape_of_drag(1.0, 1.0, 1.0, gas.shape);
    assert_true(gas.shape[0] == 24.0 && gas.shape[1] == 3.0 && gas.shape[2] == 0.42);
    dem_shape_of_drag(1.1, 1.0, 1.0, gas.shape);
    assert_true(gas.shape[0] != gas.shape[0]);
    dem_shape_of_drag(NAN, 1.0, 1.0, gas.shape);
    assert_true(gas.shape[1] != gas.shape[1]);
    dem_shape_of_drag(1.0, 0.0, 1.0, NULL);
    assert_true(fabs(dem_di_felice(31.622776601683793) - 3.05) < 1e-12 && dem_di_felice(0.0) == 3.7);
    assert_true(fabs(exp((1.0 - dem_di_felice(50.0)) * log(0.98254)) - 1.03700169369406) < 1e-13);
    assert_true(dem_di_felice(-1.0) != dem_di_felice(-1.0) && dem_di_felice(NAN) != dem_di_felice(NAN));
    assert_true(dem_drag_stokes(5.0, 1.0, &gas) == 24.0 &&
                dem_drag_stokes(-1.0, 1.0, &gas) != dem_drag_stokes(-1.0, 1.0, &gas));
    assert_true(fabs(dem_drag_schiller_naumann(100.0, 1.0, &gas) - 24.0 * (1.0 + 0.15 * pow(100.0, 0.687))) < 1e-10);
    assert_true(dem_drag_schiller_naumann(2000.0, 1.0, &gas) == 880.0 &&
                dem_drag_schiller_naumann(0.0, 1.0, &gas) == 24.0);
    assert_true(dem_drag_schiller_naumann(-1.0, 1.0, &gas) != dem_drag_schiller_naumann(-1.0, 1.0, &gas));
}

/* A law of a program: it sees the porosity. */
DEM_INLINE double drag_of_porosity(double reynolds, double porosity, const dem_gas *gas) {
    return (void)reynolds, (void)gas, 24.0 / porosity;
}

/* Laws among other particles. The values are those of the coefficient beta [kg/(m3 s)] as it is published, of 1 mm in
   air: c_D Re = (4/3) d^2 beta/(eta (1 - porosity)). */
static void laws_among_others(void **state) {
    (void)state;
    const dem_gas gas = dem_default_gas();
    static const struct {
        dem_drag_fn law;
        double reynolds, porosity, value;
    } known[] = {
        {dem_drag_gidaspow, 0.1, 0.4, 300.583333333333},
        {dem_drag_gidaspow, 50, 0.4, 591.666666666667},
        {dem_drag_gidaspow, 800, 0.4, 4966.66666666667},
        {dem_drag_gidaspow, 0.1, 0.6, 133.722222222222},
        {dem_drag_gidaspow, 50, 0.6, 327.777777777778},
        {dem_drag_gidaspow, 800, 0.6, 3244.44444444444},
        {dem_drag_gidaspow, 0.1, 0.9, 32.7083896341173},
        {dem_drag_gidaspow, 50, 0.9, 101.674178248109},
        {dem_drag_gidaspow, 800, 0.9, 501.605252224738},
        {dem_drag_beetstra, 0.1, 0.4, 363.321379820537},
        {dem_drag_beetstra, 50, 0.4, 621.800706410244},
        {dem_drag_beetstra, 800, 0.4, 3721.22867068257},
        {dem_drag_beetstra, 0.1, 0.6, 170.106507282787},
        {dem_drag_beetstra, 50, 0.6, 313.725919455709},
        {dem_drag_beetstra, 800, 0.6, 1946.72016388279},
        {dem_drag_beetstra, 0.1, 0.9, 52.544705646644},
        {dem_drag_beetstra, 50, 0.9, 125.145910718026},
        {dem_drag_beetstra, 800, 0.9, 855.993663948891},
        {dem_drag_koch_hill, 0.1, 0.4, 360.472344},
        {dem_drag_koch_hill, 50, 0.4, 596.172},
        {dem_drag_koch_hill, 800, 0.4, 4138.752},
        {dem_drag_koch_hill, 0.1, 0.61, 152.544747916236},
        {dem_drag_koch_hill, 50, 0.61, 247.166379185161},
        {dem_drag_koch_hill, 800, 0.61, 1669.33518583233},
        {dem_drag_koch_hill, 0.1, 0.9, 55.0077874888811},
        {dem_drag_koch_hill, 50, 0.9, 116.989226394231},
        {dem_drag_koch_hill, 800, 0.9, 1048.57397948065},
    };
    static const dem_drag_fn law[] = {dem_drag_stokes,   dem_drag_schiller_naumann, dem_drag_hoelzer_sommerfeld,
                                      dem_drag_gidaspow, dem_drag_beetstra,         dem_drag_koch_hill};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        const double value = known[k].law(known[k].reynolds, known[k].porosity, &gas);
        if (!(fabs(value / known[k].value - 1.0) < 1e-12)) fail_msg("row %d: %.15g", (int)k, value);
    }
    for (size_t k = 0; k < sizeof law / sizeof *law; k++) {
        assert_true(fabs(law[k](0.0, 1.0, &gas) / 24.0 - 1.0) < 1e-12); /* a single sphere at rest: Stokes */
        assert_true(fabs(law[k](1e-300, 1.0, &gas) / 24.0 - 1.0) < 1e-12);
        assert_true(fabs(law[k](0.0, 1.0 - 1e-9, &gas) / 24.0 - 1.0) < 1e-3); /* and no jump beside it */
        for (double porosity = 0.36; porosity < 0.99; porosity += 0.03) {
            /* Koch & Hill join two. */
            assert_true(law[k](1.0, porosity, &gas) > law[k](1.0, porosity + 0.01, &gas) * (k == 5 ? 0.98 : 1.0));
            assert_true(law[k](0.0, porosity, &gas) > 24.0 && isfinite(law[k](1e-300, porosity, &gas)));
            assert_true(k == 0 || law[k](100.0, porosity, &gas) > law[k](10.0, porosity, &gas));
        }
        assert_true(isnan(law[k](-1.0, 0.5, &gas)) && isnan(law[k](NAN, 0.5, &gas)) && isnan(law[k](1.0, 0.0, &gas)));
        assert_true(isnan(law[k](1.0, NAN, &gas)) && isnan(law[k](1.0, 1.0 + 1e-15, &gas)) &&
                    isnan(law[k](1.0, -0.5, &gas)));
    }
    /* Carman & Kozeny, 180 (1 - eps)^2/eps^3 eta U/d^2, of which both laws with porosities of a packing are made: a
       pressure gradient of n F/eps over a bed at rest */
    for (int k = 4; k < 6; k++) {
        const double porosity = 0.4, superficial = 1e-3, d = 1e-3, n = (1.0 - porosity) / (RIDDLE_PI / 6.0 * d * d * d);
        const double force = RIDDLE_PI / 8.0 * gas.viscosity * d * law[k](0.0, porosity, &gas) * superficial / porosity;
        const double known_gradient = 180.0 * 0.36 / 0.064 * gas.viscosity * superficial / (d * d);
        /* Beetstra adds (1 + 1.5 ..) eps^2. */
        assert_true(fabs(n * force / porosity / known_gradient - 1.0) < (k == 4 ? 0.03 : 1e-12));
    }
    /* the same exponent as before by Di Felice, and a law of the program's own, through the force */
    assert_true(fabs(dem_drag_stokes(50.0, 0.98254, &gas) / 24.0 / 1.03700169369406 - 1.0) < 1e-13);
    assert_true(dem_hindrance_di_felice(7.0, 1.0) == 1.0);
    double porosity[8] = {0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 0.5};
    dem_gas dense = gas;
    dem_force_point at;
    memset(&at, 0, sizeof at);
    dense.low = dem_vec3(-1, -1, -1), dense.high = dem_vec3(1, 1, 1);
    dense.n[0] = dense.n[1] = dense.n[2] = 2, dense.porosity = porosity;
    at.radius = 1e-3, at.velocity = dem_vec3(2.0, 0, 0);
    const dem_vec own = dem_gas_force(&at, &dense, drag_of_porosity);
    assert_true(fabs(own.x / (-2.0 * 6.0 * RIDDLE_PI * gas.viscosity * 1e-3 * 2.0) - 1.0) < 1e-14);
}

/* Porosity from the spheres; drag in it, with a pressure gradient and buoyancy, against the equations. */
static void crowd(void **state) {
    (void)state;
    double porosity[27], gradient[81], velocity[81];
    dem_world w;
    dem_def def = grains(1e-6);
    dem_gas gas = dem_default_gas();
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    const double d = 1e-4, volume = RIDDLE_PI / 6.0 * d * d * d;
    add(&w, 2.5e-4, 5e-4, 5e-4, d, dem_vec3(0, 0, 0));
    assert_int_equal(dem_gas_porosity(&w, &gas, porosity), DEM_BAD_ARGUMENT);
    gas.low = dem_vec3(0, 0, 0), gas.high = dem_vec3(1e-3, 1e-3, 1e-3);
    gas.n[0] = gas.n[1] = gas.n[2] = 3;
    assert_int_equal(dem_gas_porosity(&w, &gas, porosity), DEM_OK);
    const double cell = 1.25e-10;
    assert_true(fabs(1.0 - porosity[13] - 0.5 * volume / cell) < 1e-15 &&
                fabs(1.0 - porosity[12] - volume / cell) < 1e-15);
    assert_true(porosity[14] == 1.0 && porosity[0] == 1.0);
    for (int k = 0; k < 27; k++) {
        porosity[k] = 0.6;
        for (int a = 0; a < 3; a++)
            gradient[3 * k + a] = a == 0 ? 100.0 : 0.0, velocity[3 * k + a] = a == 1 ? 2.0 : 0.0;
    }
    gas.porosity = porosity, gas.pressure_gradient = gradient, gas.velocity = velocity, gas.buoyancy = 1;
    assert_int_equal(dem_check_gas(&gas, NULL), DEM_OK);
    dem_force_point at;
    memset(&at, 0, sizeof at);
    at.position = dem_vec3(3e-4, 6e-4, 9e-4), at.radius = 0.5 * d, at.mass = volume * density,
    at.gravity = dem_vec3(0, 0, -9.81);
    const double re = 1.2 * 0.6 * 2.0 * d / eta, cd = dem_drag_schiller_naumann(re, 1.0, &gas) / re;
    const double drag = 0.5 * 1.2 * cd * 0.25 * RIDDLE_PI * d * d * 4.0 * pow(0.6, 2.0 - dem_di_felice(re));
    const dem_vec force = dem_gas_force(&at, &gas, dem_drag_schiller_naumann);
    assert_true(fabs(force.y / drag - 1.0) < 1e-12 && fabs(force.x / (-100.0 * volume) - 1.0) < 1e-12);
    assert_true(fabs(force.z / (1.2 * 9.81 * volume) - 1.0) < 1e-12);
    at.position.x = 1.001e-3;
    assert_true(dem_gas_force(&at, &gas, dem_drag_schiller_naumann).y == 0.0); /* beyond the grid */
    assert_true(dem_gas_velocity(&gas, at.position, 0.0).x != 0.0 &&
                fabs(dem_gas_velocity(&gas, dem_vec3(0, 0, 0), 3.0).y - 2.0) < 1e-15);
    assert_true(isnan(dem_gas_velocity(NULL, at.position, 0.0).x));
    /* a quarter turn: +y becomes -x */
    gas.spin = 10.0, gas.drift = dem_vec3(0, 0, 1), gas.centre = dem_vec3(5e-4, 5e-4, 5e-4);
    const dem_vec u = dem_gas_velocity(&gas, dem_vec3(5e-4, 7e-4, 5e-4 + 0.05 * RIDDLE_PI), 0.05 * RIDDLE_PI);
    assert_true(fabs(u.x + 2.0 + 10.0 * 2e-4) < 1e-12 && fabs(u.y) < 1e-12 && u.z == 1.0);
    dem_free(&w);
}

/* ---- the ledger, and what the caller does between runs ---- */

/* Energy that is not in the books, over what the gas has taken. */
static double unbooked(double dt, int cut) {
    dem_world w;
    dem_gas air = dem_default_gas();
    const int paddle = stirred(&w, DEM_SKIP_ALL, 1, 150);
    assert_int_equal(dem_set_time_step(&w, dt), DEM_OK);
    assert_true(dem_add_exit(&w, dem_vec3(-1.1e-3, 0, 0), dem_vec3(1, 0, 0)) >= 0);
    assert_int_equal(dem_attach_gas(&air, &w, paddle), DEM_OK);
    dem_force_field f = dem_gas_field(schiller, &air);
    assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
    for (int k = 0; k < 4; k++) {
        assert_int_equal(dem_run(&w, 1e-4, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY), DEM_OK);
        if (cut && k == 1) assert_int_equal(dem_set_motion(&w, 3, dem_vec3(1, 1, 1), dem_vec3(0, 0, 0)), DEM_OK);
        if (cut && k == 2) assert_int_equal(dem_remove(&w, 5), DEM_OK);
        if (cut && k == 2) add(&w, 0, 1e-3, 0, 50e-6, dem_vec3(1, 0, 0));
    }
    const dem_energy_ledger e = dem_energy(&w);
    assert_true(w.passed_total > 0 && e.normal_loss > 0.0 && e.field_work != 0.0);
    const double off = fabs(e.error) / (fabs(e.field_work) + e.normal_loss);
    if (getenv("SAY")) printf("ledger: dt %g off %g, field %g, normal %g\n", dt, off, e.field_work, e.normal_loss);
    dem_free(&w);
    return off;
}
static void ledger(void **state) {
    (void)state;
    assert_true(unbooked(2e-8, 0) < 2e-3 && unbooked(2e-8, 1) < 2e-3 && unbooked(5e-9, 1) < 2e-4);
    /* alone, the work is known: that of Stokes's drag on a sphere that it stops is its energy */
    dem_world w;
    dem_gas air = dem_default_gas();
    dem_def def = grains(1e-7);
    def.gravity = dem_vec3(0, 0, 0);
    dem_force_field f = dem_gas_field(stokes, &air);
    for (int late = 0; late < 2; late++) { /* late: the ledger begins in mid-flight */
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        add(&w, 0, 0, 0, 20e-6, dem_vec3(3, 0, 0));
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        for (int k = 0; k < 10 && late; k++) assert_int_equal(dem_run(&w, 1.03e-4, DEM_LINEAR), DEM_OK);
        assert_int_equal(dem_run(&w, 0.0, DEM_LINEAR | DEM_ENERGY), DEM_OK);
        const double start = dem_energy(&w).kinetic;
        assert_int_equal(dem_run(&w, 0.05, DEM_LINEAR | DEM_ENERGY), DEM_OK);
        assert_true(fabs(dem_energy(&w).field_work / start + 1.0) < (late ? 1e-5 : 1e-9));
        assert_true(fabs(dem_energy(&w).error) < (late ? 1e-5 : 1e-9) * start);
        dem_free(&w);
    }
}

/* Runs cut into pieces, one of them without time, and a field set again make no difference. */
static void pieces(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int run = 0; run < 2; run++) {
        dem_world w;
        dem_gas air = dem_default_gas();
        const int paddle = stirred(&w, DEM_SKIP_ALL, 1, 200);
        assert_int_equal(dem_attach_gas(&air, &w, paddle), DEM_OK);
        dem_force_field f = dem_gas_field(hoelzer, &air);
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        assert_int_equal(dem_run(&w, 0.0, DEM_LINEAR), DEM_OK);
        for (int k = 0; k < (run ? 40 : 1); k++) assert_int_equal(dem_run(&w, run ? 5e-6 : 2e-4, DEM_LINEAR), DEM_OK);
        hash[run] = dem_hash(&w);
        dem_free(&w);
    }
    assert_true(hash[0] == hash[1]);
}

/* A world saved in mid-flight and loaded goes on with the same bits and books, once its field is named again. */
static void saved(void **state) {
    (void)state;
    dem_world w, again;
    dem_gas air = dem_default_gas();
    const int paddle = stirred(&w, DEM_SKIP_ALL, 1, 200), features = DEM_LINEAR | DEM_FRICTION | DEM_ENERGY;
    assert_int_equal(dem_attach_gas(&air, &w, paddle), DEM_OK);
    dem_force_field f = dem_gas_field(schiller, &air);
    assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
    assert_int_equal(dem_run(&w, 1e-4, features), DEM_OK);
    assert_true(dem_contact_count(&w) > 0);
    const size_t size = dem_save(&w, NULL, 0);
    void *bytes = malloc(size);
    assert_non_null(bytes);
    assert_int_equal(dem_save(&w, bytes, size), size);
    assert_int_equal(dem_load(&again, bytes, size, NULL), DEM_OK);
    assert_true(dem_hash(&again) == dem_hash(&w));
    assert_int_equal(dem_run(&again, 1e-4, features), DEM_NO_FIELD);
    assert_int_equal(dem_set_force_field(&again, &f), DEM_OK);
    for (int k = 0; k < 2; k++) {
        assert_int_equal(dem_run(&again, 1e-4, features), DEM_OK);
        assert_int_equal(dem_run(&w, 1e-4, features), DEM_OK);
        assert_true(dem_hash(&again) == dem_hash(&w));
    }
    const double work = dem_energy(&w).field_work;
    assert_true(fabs(dem_energy(&again).field_work - work) <= 1e-12 * fabs(work));
    free(bytes);
    dem_free(&w), dem_free(&again);
}

/* A field that is there in a part of space only, and in a periodic box. */
static dem_vec gust(const dem_force_point *at) {
    const double here = at->position.x > 2e-4 && at->position.x < 5e-4 ? 1.0 : 0.0;
    return dem_vec3(0, here * 200.0 * at->mass, 0);
}
DEM_FORCE_FIELD(gust_field, gust)
static void local_field(void **state) {
    (void)state;
    for (int run = 0; run < 3; run++) {
        dem_world w;
        dem_def def = grains(1e-7);
        def.gravity = dem_vec3(0, 0, 0);
        def.periodic[0] = 1;
        def.low = dem_vec3(0, 0, 0), def.high = dem_vec3(1e-3, 1, 1);
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        add(&w, 1e-4, 0, 0, 20e-6, dem_vec3(1, 0, 0));
        dem_force_field f = dem_default_force_field(gust_field, NULL);
        f.length = run == 0 ? 1e-5 : run == 1 ? 1e-6 : 2e-7;
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        assert_int_equal(dem_run(&w, 3e-3, DEM_LINEAR), DEM_OK); /* three times through */
        const double gain = 3.0 * 200.0 * 3e-4, v = dem_velocity(&w, 0).y;
        assert_true(fabs(v / gain - 1.0) < (run == 0 ? 2e-2 : run == 1 ? 2e-3 : 1e-3));
        assert_true(fabs(dem_velocity(&w, 0).x - 1.0) < 1e-14);
        dem_free(&w);
    }
}

/* A particle with a load takes steps, and feels the field as others do. */
static void stepping(void **state) {
    (void)state;
    double z[2];
    for (int run = 0; run < 2; run++) {
        dem_world w;
        dem_gas air = dem_default_gas();
        dem_def def = grains(1e-6);
        dem_force_field f = dem_gas_field(schiller, &air);
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        add(&w, 0, 0, 0, 50e-6, dem_vec3(2, 0, 0));
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        if (run) assert_int_equal(dem_set_load(&w, 0, dem_vec3(1e-300, 0, 0), dem_vec3(0, 0, 0)), DEM_OK);
        assert_int_equal(dem_run(&w, 5e-3, DEM_LINEAR), DEM_OK);
        if (run) assert_int_equal(dem_set_load(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 0)), DEM_OK);
        assert_int_equal(dem_run(&w, 5e-3, DEM_LINEAR), DEM_OK);
        z[run] = dem_position(&w, 0).z;
        dem_free(&w);
    }
    assert_true(fabs(z[1] / z[0] - 1.0) < 1e-7);
}

/* Steps of their own against steps of the world for all: as many contacts, for far less work. */
static void multi_rate(void **state) {
    (void)state;
    double contacts[2][6], mean[2] = {0, 0}, square[2] = {0, 0};
    for (int run = 0; run < 2; run++) {
        for (int seed = 0; seed < 6; seed++) {
            dem_world w;
            dem_gas air = dem_default_gas();
            const int paddle = stirred(&w, DEM_SKIP_ALL, 1, 60 + seed);
            assert_int_equal(dem_attach_gas(&air, &w, paddle), DEM_OK);
            dem_force_field f = dem_gas_field(schiller, &air);
            assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
            for (ptrdiff_t i = 0; i < w.count && run; i++)
                dem_set_load(&w, i, dem_vec3(1e-300, 0, 0), dem_vec3(0, 0, 0));
            assert_int_equal(dem_run(&w, 4e-4, DEM_LINEAR), DEM_OK);
            contacts[run][seed] = (double)w.contact_steps;
            mean[run] += contacts[run][seed] / 6.0;
            dem_free(&w);
        }
        for (int seed = 0; seed < 6; seed++) square[run] += pow(contacts[run][seed] - mean[run], 2.0) / 30.0;
    }
    if (getenv("SAY"))
        printf("contact steps %.0f +- %.0f, with one step for all %.0f +- %.0f\n", mean[0], sqrt(square[0]), mean[1],
               sqrt(square[1]));
    assert_true(fabs(mean[0] - mean[1]) < 3.0 * sqrt(square[0] + square[1]));
}

static void bad_input(void **state) {
    (void)state;
    dem_world w;
    dem_def def = grains(1e-6);
    dem_gas gas = dem_default_gas();
    const char *field = NULL;
    const double bad[] = {NAN, 0.0, -1.0, 1.0, HUGE_VAL};
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    dem_force_field f = dem_gas_field(stokes, &gas), g = f;
    assert_int_equal(dem_set_force_field(NULL, &f), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_set_force_field(&w, NULL), DEM_OK); /* there is none */
    g.kernel = NULL;
    assert_int_equal(dem_set_force_field(&w, &g), DEM_BAD_ARGUMENT);
    for (int k = 0; k < 5; k++) {
        g = f, g.accuracy = bad[k];
        assert_int_equal(dem_set_force_field(&w, &g), DEM_BAD_ARGUMENT);
        if (k > 2) continue;
        g = f, g.length = bad[k];
        assert_int_equal(dem_set_force_field(&w, &g), DEM_BAD_ARGUMENT);
        g = f, g.interval = bad[k];
        assert_int_equal(dem_set_force_field(&w, &g), DEM_BAD_ARGUMENT);
        gas = dem_default_gas(), gas.density = bad[k];
        assert_true(dem_check_gas(&gas, &field) == DEM_BAD_DEFINITION && strcmp(field, "density") == 0);
        gas = dem_default_gas(), gas.viscosity = bad[k];
        assert_true(dem_check_gas(&gas, &field) == DEM_BAD_DEFINITION && strcmp(field, "viscosity") == 0);
    }
    gas = dem_default_gas(), gas.axis = dem_vec3(0, 0, 2);
    assert_true(dem_check_gas(&gas, &field) == DEM_BAD_DEFINITION && strcmp(field, "axis") == 0);
    gas = dem_default_gas(), gas.velocity = bad;
    assert_true(dem_check_gas(&gas, &field) == DEM_BAD_DEFINITION && strcmp(field, "n") == 0);
    assert_int_equal(dem_check_gas(NULL, &field), DEM_BAD_DEFINITION);
    gas = dem_default_gas();
    assert_int_equal(dem_attach_gas(&gas, &w, 0), DEM_BAD_ARGUMENT);
    const int wall = dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
    assert_int_equal(dem_vibrate(&w, wall, dem_vec3(1e-3, 0, 0), dem_vec3(0, 0, 0), 50.0), DEM_OK);
    assert_int_equal(dem_attach_gas(&gas, &w, wall), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_attach_gas(NULL, &w, wall), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_gas_porosity(&w, NULL, NULL), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR), DEM_OK); /* and an empty world runs in a field */
    assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
    assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR), DEM_OK);
    dem_free(&w);
}

/* A field taken off: free fall from then on. A law that gives NaN: a status. */
static dem_vec broken(const dem_force_point *at) { return dem_vec3(at->time > 5e-4 ? (double)NAN : 0.0, 0, 0); }
DEM_FORCE_FIELD(broken_field, broken)
static void taken_off(void **state) {
    (void)state;
    dem_world w;
    dem_gas air = dem_default_gas();
    dem_def def = grains(1e-6);
    dem_force_field f = dem_gas_field(schiller, &air);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    add(&w, 0, 0, 0, 50e-6, dem_vec3(2, 0, 0));
    assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
    assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR), DEM_OK);
    const dem_vec v = dem_velocity(&w, 0);
    assert_int_equal(dem_set_force_field(&w, NULL), DEM_OK);
    assert_int_equal(dem_run(&w, 1e-3, DEM_LINEAR), DEM_OK);
    assert_true(fabs(dem_velocity(&w, 0).x - v.x) < 1e-6 && fabs(dem_velocity(&w, 0).z - v.z + 9.81e-3) < 1e-6);
    f = dem_default_force_field(broken_field, NULL);
    f.interval = 1e-5;
    assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
    assert_int_equal(dem_set_time_step(&w, 1e-6), DEM_OK);
    assert_true(dem_run(&w, 1e-2, DEM_LINEAR) != DEM_OK);
    dem_free(&w);
}

/* Every allocation that may fail, fails once: a status, and a world that goes on. */
static void short_of_memory(void **state) {
    (void)state;
    int failed = 0;
    for (int at = 0; at < 60; at++) {
        failing_allocator memory;
        failing_init_at(&memory, at);
        dem_world w;
        dem_gas air = dem_default_gas();
        dem_force_field f = dem_gas_field(schiller, &air);
        dem_def def = grains(1e-6);
        def.allocator.fn = failing_fn, def.allocator.user = &memory;
        dem_status status = dem_init(&w, &def, NULL);
        const double centre[6] = {0, 0, 1e-3, 0, 0, 2e-3}, d[2] = {1e-4, 2e-4};
        if (status == DEM_OK) status = dem_add_spheres(&w, 1, centre, d, 0, 0);
        if (status == DEM_OK) status = dem_set_force_field(&w, &f);
        if (status == DEM_OK) status = dem_add_spheres(&w, 1, centre + 3, d + 1, 0, 0);
        if (status == DEM_OK) status = dem_run(&w, 1e-4, DEM_LINEAR | DEM_ENERGY);
        if (status == DEM_OUT_OF_MEMORY) failed++;
        else assert_int_equal(status, DEM_OK);
        dem_free(&w);
        assert_int_equal(failing_live(&memory), 0);
        assert_int_equal(memory.misused, 0);
    }
    assert_true(failed > 3);
}

/* ---- bodies: they feel the field at their centre, as a sphere of their volume ---- */

/* Adds n clumps, or bricks, turned at random, with velocities; of the volume of a sphere of d. */
static void add_bodies(dem_world *w, int bricks, int n, double d, uint64_t random) {
    const double ends[6] = {0, 0, -0.5, 0, 0, 0.5}, two[2] = {1.0, 1.0}, a = d * cbrt(3.14159265358979324 / 6.0 / 2.08);
    double v[7];
    dem_clump pair;
    dem_convex brick;
    assert_int_equal(dem_make_clump(2, ends, two, &pair), DEM_OK);
    assert_int_equal(dem_make_brick(&brick, dem_vec3(a, a, 2.08 * a), 0.03, NULL), DEM_OK);
    const int shape = bricks ? dem_add_shape(w, &brick) : 0;
    assert_true(shape >= 0);
    for (int k = 0; k < n; k++) {
        const double at[3] = {(k % 8 - 3.5) * 2.5e-4, 6e-4 + 1.5e-4 * (k / 8), bricks ? 2e-4 : -2e-4};
        for (int q = 0; q < 7; q++) v[q] = 2.0 * random_plain(&random) - 1.0;
        if (bricks) assert_int_equal(dem_add_convex(w, shape, 1, at, v, 0, 0), DEM_OK);
        else assert_int_equal(dem_add_clumps(w, 1, &pair, at, &d, v, 0, 0), DEM_OK);
        assert_int_equal(
            dem_set_motion(w, w->count - 1, dem_vec3(2 * v[4], 2 * v[5], v[6]), dem_vec3(3e3 * v[0], 3e3 * v[1], 0)),
            DEM_OK);
    }
}

/* In Stokes's law a body of any shape relaxes as the sphere of its volume, whatever its spin; a clump of one is that
   sphere, in flight and in a hit. */
static void bodies_relax(void **state) {
    (void)state;
    const double d = 20e-6, tau = density * d * d / 18.0 / eta, one[3] = {0, 0, 0};
    dem_gas air = dem_default_gas();
    dem_force_field f = dem_gas_field(stokes, &air);
    dem_def def = grains(1e-7);
    dem_clump ball;
    assert_int_equal(dem_make_clump(1, one, &d, &ball), DEM_OK);
    for (int kind = 0; kind < 2; kind++) {
        dem_world w;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        add_bodies(&w, kind, 1, d, 5);
        const dem_body from = dem_get_body(&w, 0);
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        for (int k = 0; k < 6; k++) {
            assert_int_equal(dem_run(&w, 0.3 * tau, DEM_LINEAR | DEM_FRICTION), DEM_OK);
            const double e = exp(-w.time / tau), fall = -9.81 * tau;
            const dem_body b = dem_get_body(&w, 0);
            assert_true(fabs(b.velocity.x / (from.velocity.x * e) - 1.0) < 2e-8);
            assert_true(fabs(b.velocity.z - (from.velocity.z * e + fall * (1.0 - e))) < 2e-8 * fabs(from.velocity.z));
            assert_true(fabs((b.position.x - from.position.x) / (from.velocity.x * tau * (1.0 - e)) - 1.0) < 2e-8);
        }
        dem_free(&w);
    }
    dem_vec at[2], v[2];
    for (int kind = 0; kind < 2; kind++) {
        dem_world w;
        const double centre[3] = {0, 0, 3e-4};
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        assert_true(dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0.1, 1)) >= 0);
        if (kind) assert_int_equal(dem_add_clumps(&w, 1, &ball, centre, NULL, NULL, 0, 0), DEM_OK);
        else assert_int_equal(dem_add_spheres(&w, 1, centre, &d, 0, 0), DEM_OK);
        assert_int_equal(dem_set_motion(&w, 0, dem_vec3(1, 0, -2), dem_vec3(0, 0, 0)), DEM_OK);
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        assert_int_equal(dem_run(&w, 4e-4, DEM_LINEAR | DEM_FRICTION), DEM_OK);
        assert_true(w.contact_steps > 0);
        at[kind] = dem_position(&w, 0), v[kind] = dem_velocity(&w, 0);
        dem_free(&w);
    }
    assert_true(v[0].z > 0.05 && dem__length(dem__sub(at[1], at[0])) < 1e-12 * 3e-4 &&
                dem__length(dem__sub(v[1], v[0])) < 1e-11);
}

/* Bodies among spheres, stirred in gas: the same bits whatever is skipped, with threads, in pieces and after a save;
   the ledger closes. */
static void stirred_bodies(void **state) {
    (void)state;
    uint64_t hash[5] = {0, 0, 0, 0, 0};
    static const int skips[] = {DEM_SKIP_ALL, 0, DEM_SKIP_ALL, DEM_SKIP_ALL, DEM_SKIP_SPACE},
                     features = DEM_LINEAR | DEM_FRICTION;
    for (int run = 0; run < 5; run++) {
        dem_world w, again;
        dem_gas air = dem_default_gas();
        const int paddle = stirred(&w, skips[run], run == 2 ? 3 : 1, 0);
        add_bodies(&w, 0, 40, 60e-6, 3);
        add_bodies(&w, 1, 24, 50e-6, 4);
        for (int k = 0; k < 8; k++) add(&w, (k - 3.5) * 2e-4, -6e-4, 0, 70e-6, dem_vec3(0, 1, 0));
        assert_int_equal(dem_attach_gas(&air, &w, paddle), DEM_OK);
        dem_force_field f = dem_gas_field(hoelzer, &air);
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        for (int k = 0; k < 10; k++) {
            assert_int_equal(dem_run(&w, 3e-5, features | (run == 1 ? DEM_ENERGY : 0)), DEM_OK);
            if (run != 3 || k != 4) continue;
            const size_t size = dem_save(&w, NULL, 0);
            void *bytes = malloc(size);
            assert_non_null(bytes);
            assert_int_equal(dem_save(&w, bytes, size), size);
            assert_int_equal(dem_load(&again, bytes, size, NULL), DEM_OK);
            dem_free(&w), free(bytes);
            w = again;
            assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        }
        hash[run] = dem_hash(&w);
        assert_true(w.contact_steps > 1000);
        say(&w, "bodies");
        if (run == 1) {
            const dem_energy_ledger e = dem_energy(&w);
            if (getenv("SAY")) printf("off %g field %g loss %g\n", e.error, e.field_work, e.normal_loss);
            assert_true(e.field_work != 0.0 &&
                        fabs(e.error) < 2e-3 * (fabs(e.field_work) + e.normal_loss + e.sliding_loss));
        }
        dem_free(&w);
    }
    for (int run = 1; run < 5; run++) assert_true(hash[run] == hash[0]);
}

/* A sphere, a rod of three spheres and a brick of one volume. Returns the moment of inertia about z. */
static double add_spinner(dem_world *w, int kind, double d, double z) {
    const double volume = RIDDLE_PI / 6.0 * d * d * d, rho = density, at[3] = {0, 0, z}, none[4] = {1, 0, 0, 0};
    const double centre[9] = {-0.4, 0, 0, 0, 0, 0, 0.4, 0, 0}, width[3] = {0.6, 0.8, 0.6};
    dem_clump rod;
    dem_convex brick;
    if (kind == 0) {
        assert_int_equal(dem_add_spheres(w, 1, at, &d, 0, 0), DEM_OK);
        return 0.1 * rho * volume * d * d;
    }
    if (kind == 1) {
        assert_int_equal(dem_make_clump(3, centre, width, &rod), DEM_OK);
        assert_int_equal(dem_add_clumps(w, 1, &rod, at, &d, none, 0, 0), DEM_OK);
    } else {
        const double a = cbrt(volume / 6.0);
        assert_int_equal(dem_make_brick(&brick, dem_vec3(2.0 * a, 3.0 * a, a), 0.05, NULL), DEM_OK);
        assert_int_equal(dem_add_convex(w, dem_add_shape(w, &brick), 1, at, none, 0, 0), DEM_OK);
    }
    const dem_body b = dem_get_body(w, w->count - 1);
    if (kind == 2) return b.mass / 12.0 * 13.0 * pow(volume / 6.0, 2.0 / 3.0);
    return fmax(fmax(b.moments.x, b.moments.y), b.moments.z);
}

/* A spin decays as that of the sphere of equal volume with the body's inertia: exp(-pi eta d^3 t/I); in fast rotation
   by Dennis, Singh & Ingham's torque, integrated by this test. Its energy is booked. In flight, and on a plane
   about its normal. */
static void spins_decay(void **state) {
    (void)state;
    for (int trial = 0; trial < 36; trial++) {
        const int kind = trial % 3, rests = trial / 3 % 2, size = trial / 6 % 3, skips = trial < 18;
        const double d = size == 0 ? 1e-4 : size == 1 ? 1e-3 : 1.5e-3, fast = size == 2 ? 3000.0 : 0.0;
        if (rests && (kind || size != 1 || !skips)) continue;
        dem_world w;
        dem_gas air = dem_default_gas();
        const dem_force_field f = dem_gas_field(schiller, &air);
        dem_def def = grains(rests || size != 1 ? 1e-5 : 2e-4);
        def.gravity = dem_vec3(0, 0, rests ? -9.81 : 0.0);
        if (!skips) def.skip = 0;
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        if (rests) assert_true(dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1)) >= 0);
        const double inertia = add_spinner(&w, kind, d, 0.5 * d * (1.0 - 1e-7)), c = RIDDLE_PI * eta * d * d * d,
                     time = inertia / c;
        double spin = fast > 0.0 ? fast : 0.3 * 32.0 * eta / (1.2 * d * d);
        assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, spin)), DEM_OK);
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        const double first = spin, pause = (rests ? 0.02 : size == 2 ? 0.1 : 0.37) * time;
        for (int k = 0; k < 4; k++) {
            assert_int_equal(dem_run(&w, pause, DEM_LINEAR | DEM_FRICTION | DEM_ENERGY), DEM_OK);
            for (int n = 0; n < 2000 && fast > 0.0; n++) { /* Heun */
                double rate[2], now = spin;
                for (int q = 0; q < 2; q++) {
                    const double re = 1.2 * d * d * now / eta;
                    rate[q] = -now / time * fmax(1.0, (12.9 * sqrt(re) + 128.4) / (64.0 * RIDDLE_PI));
                    now = spin + pause / 2000.0 * rate[0];
                }
                spin += pause / 2000.0 * 0.5 * (rate[0] + rate[1]);
            }
            if (fast == 0.0) spin = first * exp(-w.time / time);
            const dem_vec s = dem_spin(&w, 0);
            const dem_energy_ledger e = dem_energy(&w);
            if (getenv("SAY"))
                printf("kind %d d %g rests %d t/tau %.3f spin/exact - 1: %.2g, ledger %.2g\n", kind, d, rests,
                       w.time / time, s.z / spin - 1.0, e.error / e.rotational);
            assert_true(fabs(s.z / spin - 1.0) < 6e-3 && fabs(s.x) + fabs(s.y) < 1e-9 * s.z);
            assert_true(fabs(e.error) < 1e-6 * inertia * first * first);
        }
        dem_free(&w);
    }
}

/* At last a sphere turns with the gas: with its frame, and with half the curl of its velocity; beyond the grid it
   keeps its spin. */
static void spins_with_gas(void **state) {
    (void)state;
    const double d = 1e-4, shear = 50.0;
    double velocity[24];
    for (int k = 0; k < 8; k++)
        velocity[3 * k] = shear * ((k >> 1 & 1) - 0.5), velocity[3 * k + 1] = velocity[3 * k + 2] = 0.0;
    for (int run = 0; run < 3; run++) {
        dem_world w;
        dem_gas air = dem_default_gas();
        dem_def def = grains(1e-5);
        def.gravity = dem_vec3(0, 0, 0);
        if (run == 0) air.spin = 30.0, air.axis = dem_vec3(0, 0, 1);
        if (run) {
            air.low = dem_vec3(-0.5, -0.5, -0.5), air.high = dem_vec3(0.5, 0.5, 0.5), air.velocity = velocity;
            for (int a = 0; a < 3; a++) air.n[a] = 2;
        }
        const dem_force_field f = dem_gas_field(stokes, &air);
        assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
        add(&w, run == 2 ? 2.0 : 0.0, 0, 0, d, dem_vec3(0, 0, 0));
        assert_int_equal(dem_set_motion(&w, 0, dem_vec3(0, 0, 0), dem_vec3(7, 0, 0)), DEM_OK);
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        assert_int_equal(dem_run(&w, 20.0 * density * d * d / 60.0 / eta, DEM_LINEAR | DEM_FRICTION), DEM_OK);
        const dem_vec s = dem_spin(&w, 0);
        assert_true(fabs(s.z - (run == 0 ? 30.0 : run == 1 ? -0.5 * shear : 0.0)) < 0.02);
        assert_true(fabs(s.x - (run == 2 ? 7.0 : 0.0)) < (run == 2 ? 1e-15 : 0.02));
        dem_free(&w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(relaxation),
                                       cmocka_unit_test(schiller_naumann),
                                       cmocka_unit_test(laws), cmocka_unit_test(laws_among_others),
                                       cmocka_unit_test(crowd),
                                       cmocka_unit_test(skipping_is_exact),
                                       cmocka_unit_test(no_field_no_change),
                                       cmocka_unit_test(turning_frame),
                                       cmocka_unit_test(ledger),
                                       cmocka_unit_test(saved),
                                       cmocka_unit_test(pieces),
                                       cmocka_unit_test(local_field),
                                       cmocka_unit_test(stepping),
                                       cmocka_unit_test(multi_rate),
                                       cmocka_unit_test(bodies_relax),
                                       cmocka_unit_test(stirred_bodies),
                                       cmocka_unit_test(spins_decay),
                                       cmocka_unit_test(spins_with_gas),
                                       cmocka_unit_test(bad_input),
                                       cmocka_unit_test(taken_off),
                                       cmocka_unit_test(short_of_memory)};
    if (getenv("RIDDLE_TEST")) cmocka_set_test_filter(getenv("RIDDLE_TEST"));
    return cmocka_run_group_tests(tests, NULL, NULL);
}
