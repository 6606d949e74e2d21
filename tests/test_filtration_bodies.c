/* Bodies of spheres in the resolved fluid: dem.h moves clumps, filtration.h knows their spheres. The host's part is
   couple() below. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "dem.h"
#include "filtration.h"

enum { MOST = 8 };
static const double voxel = 1e-6, viscosity = 1e-3, density = 2200.0;

typedef struct suspension {
    dem_world world;
    filtration_fluid fluid;
    filtration_spheres spheres;
    double centre[3 * MOST], velocity[3 * MOST], spin[3 * MOST], radius[MOST], force[3 * MOST], torque[3 * MOST];
} suspension;

/* One step of the fluid: the spheres as dem.h has them, and the fluid's forces as loads. A load on a particle acts on
   its body. `extra` is shared by the particles; `turn`: a torque on particle 0. */
static void couple(suspension *s, dem_vec extra, dem_vec turn) {
    const int n = (int)s->spheres.n;
    for (int k = 0; k < n; k++) {
        const dem_vec x = dem_position(&s->world, k), v = dem_velocity(&s->world, k), w = dem_spin(&s->world, k);
        const double values[9] = {x.x, x.y, x.z, v.x, v.y, v.z, w.x, w.y, w.z};
        memcpy(s->centre + 3 * k, values, 3 * sizeof *values);
        memcpy(s->velocity + 3 * k, values + 3, 3 * sizeof *values);
        memcpy(s->spin + 3 * k, values + 6, 3 * sizeof *values);
        s->radius[k] = dem_radius(&s->world, k);
    }
    assert_int_equal(filtration_fluid_step(&s->fluid, &s->spheres), FILTRATION_OK);
    for (int k = 0; k < n; k++) {
        const double *f = s->force + 3 * k, *t = s->torque + 3 * k;
        const dem_vec load = dem_vec3(f[0] + extra.x / n, f[1] + extra.y / n, f[2] + extra.z / n);
        const dem_vec moment =
            k > 0 ? dem_vec3(t[0], t[1], t[2]) : dem_vec3(t[0] + turn.x, t[1] + turn.y, t[2] + turn.z);
        assert_int_equal(dem_set_load(&s->world, k, load, moment), DEM_OK);
    }
    assert_int_equal(dem_run(&s->world, s->fluid.dt, DEM_LINEAR), DEM_OK);
}

/* A body of spheres about the middle of a periodic box, a little off the lattice. push: force on it [N], which is taken
   off the liquid. */
static void begin(suspension *s, int nodes, int n, const double *centres, const double *diameters, dem_vec push) {
    filtration_fluid_def def = filtration_fluid_default_def();
    dem_def solid = dem_default_def();
    dem_clump clump;
    const double middle = 0.5 * nodes * voxel,
                 place[3] = {middle + 0.13 * voxel, middle - 0.31 * voxel, middle + 0.42 * voxel};
    memset(s, 0, sizeof *s);
    assert_int_equal(dem_make_clump(n, centres, diameters, &clump), DEM_OK);
    def.voxel = voxel, def.tau = 3.5;
    def.nodes[0] = def.nodes[1] = def.nodes[2] = nodes;
    const double liquid = pow(nodes * voxel, 3.0) - clump.volume;
    def.body_force[0] = -push.x / liquid, def.body_force[1] = -push.y / liquid, def.body_force[2] = -push.z / liquid;
    assert_int_equal(filtration_fluid_init(&s->fluid, &def), FILTRATION_OK);
    const int material = dem_add_material(&solid, density, 1e8, 0.3);
    solid.dt = s->fluid.dt, solid.gravity = dem_vec3(0.0, 0.0, 0.0);
    assert_int_equal(dem_init(&s->world, &solid, NULL), DEM_OK);
    assert_int_equal(dem_add_clumps(&s->world, 1, &clump, place, NULL, NULL, material, 0), DEM_OK);
    const filtration_spheres all = {s->world.count, s->centre, s->velocity, s->spin, s->radius, s->force, s->torque};
    assert_true(s->world.count <= MOST);
    s->spheres = all;
}

/* Velocity relative to the mean of the box, liquid and body. */
static void relative_velocity(const suspension *s, double volume, double u[3]) {
    const dem_body body = dem_get_body(&s->world, 0);
    const double v[3] = {body.velocity.x, body.velocity.y, body.velocity.z};
    double mean[3];
    filtration_fluid_mean_velocity(&s->fluid, mean);
    for (int a = 0; a < 3; a++) u[a] = v[a] - mean[a] - v[a] * volume / pow(s->fluid.def.nodes[0] * voxel, 3.0);
}

static void end(suspension *s) {
    filtration_fluid_free(&s->fluid);
    dem_free(&s->world);
}

/* Two touching spheres, aslant to the lattice: mobility along and across their line (Stimson and Jeffery 1926: 0.6451
   of Stokes for each;
   Batchelor 1976: 0.7246), less that of the images in a periodic box, 2.8373 / (6 pi mu L) (Hasimoto 1959); spin about
   their line (Jeffery 1915: 3/4 zeta(3) of a single sphere's torque for each). A force does not turn them. */
static void test_rod_of_two_spheres(void **state) {
    (void)state;
    static suspension s;
    const int nodes = 60;
    const double R = 4.0 * voxel, L = nodes * voxel, pi = RIDDLE_PI, unit = 6.0 * pi * viscosity;
    const double along[3] = {1.0 / sqrt(14.0), 2.0 / sqrt(14.0), 3.0 / sqrt(14.0)};
    double centres[6];
    for (int a = 0; a < 3; a++) centres[a] = -R * along[a], centres[3 + a] = R * along[a];
    const double diameters[2] = {2.0 * R, 2.0 * R}, F = unit * R * 4e-3, T = 8.0 * pi * viscosity * R * R * R * 500.0;
    const dem_vec push = dem_vec3(0.0, 0.0, F), turn = dem_vec3(T * along[0], T * along[1], T * along[2]);
    begin(&s, nodes, 2, centres, diameters, push);
    for (int step = 0; step < 420; step++) couple(&s, push, turn);
    double u[3], line = 0.0, cross = 0.0, aside = 0.0;
    relative_velocity(&s, 8.0 / 3.0 * pi * R * R * R, u);
    for (int a = 0; a < 3; a++) line += u[a] * along[a];
    for (int a = 0; a < 3; a++) cross += (u[a] - line * along[a]) * ((a == 2) - along[2] * along[a]);
    cross /= 1.0 - along[2] * along[2]; /* along the part of the force across the line */
    for (int a = 0; a < 3; a++) aside += pow(u[a] - line * along[a] - cross * ((a == 2) - along[2] * along[a]), 2.0);
    const double images = 2.8373 / (unit * L);
    const double exact_line = (1.0 / (2.0 * 0.6451 * unit * R) - images) * F * along[2];
    const double exact_cross = (1.0 / (2.0 * 0.7246 * unit * R) - images) * F;
    const dem_body body = dem_get_body(&s.world, 0);
    const double spin = body.spin.x * along[0] + body.spin.y * along[1] + body.spin.z * along[2];
    const double other = sqrt(pow(body.spin.x - spin * along[0], 2.0) + pow(body.spin.y - spin * along[1], 2.0) +
                              pow(body.spin.z - spin * along[2], 2.0));
    /* what remains falls as (R / L)^3 */
    assert_true(fabs(line / exact_line - 1.0) < 0.02 && fabs(cross / exact_cross - 1.0) < 0.02 &&
                sqrt(aside) < 0.005 * exact_cross);
    assert_true(fabs(spin / (500.0 / (2.0 * 0.90154)) - 1.0) < 0.02 && other < 0.01 * spin);
    end(&s);
}

/* Spheres that overlap count once: two that nearly coincide move as one sphere (Hasimoto 1959). */
static void test_spheres_that_overlap(void **state) {
    (void)state;
    static suspension s;
    const int nodes = 32;
    const double R = 4.2 * voxel, L = nodes * voxel, pi = RIDDLE_PI, unit = 6.0 * pi * viscosity, F = unit * R * 4e-3;
    const double centres[6] = {0.0, 0.0, 0.0, 2e-3 * R, -1e-3 * R, 3e-3 * R}, diameters[2] = {2.0 * R, 2.0 * R};
    begin(&s, nodes, 2, centres, diameters, dem_vec3(0.0, F, 0.0));
    for (int step = 0; step < 250; step++) couple(&s, dem_vec3(0.0, F, 0.0), dem_vec3(0.0, 0.0, 0.0));
    double u[3];
    relative_velocity(&s, 4.0 / 3.0 * pi * R * R * R, u);
    const double exact = F / (unit * R) * (1.0 - 2.8373 * R / L + 4.19 * pow(R / L, 3.0));
    assert_true(fabs(u[1] / exact - 1.0) < 0.02);
    end(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rod_of_two_spheres),
                                       cmocka_unit_test(test_spheres_that_overlap)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
