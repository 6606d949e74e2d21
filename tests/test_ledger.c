/* The energy ledger of dem.h where callers act on links, on force fields and on bodies between runs: what they do is
   booked, and the ledger's error stays the error of integration. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include "near.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dem.h"

static dem_vec v3(double x, double y, double z) { return dem_vec3(x, y, z); }
static void run(dem_world *w, double t, int features) {
    const dem_status status = dem_run(w, t, features);
    if (status != DEM_OK)
        fail_msg("%s, particle %lu, step %ld", dem_status_text(status), (unsigned long)w->failed_id, (long)w->step);
}
/* Saves a world and replaces it by what is loaded. */
static void reload(dem_world *w) {
    const size_t bytes = dem_save(w, NULL, 0);
    void *saved = malloc(bytes);
    assert_non_null(saved);
    dem_save(w, saved, bytes);
    dem_free(w);
    assert_int_equal(dem_load(w, saved, bytes, NULL), DEM_OK);
    free(saved);
}

static const double size = 0.004, interval = 2e-5;

static void make(dem_world *w, double friction, dem_vec gravity) {
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 2500.0, 1e7, 0.2);
    dem_pair_def *p = dem_pair(&def, m, m);
    p->restitution = 1.0, p->stiffness = 1e3, p->friction = friction;
    def.gravity = gravity, def.dt = 1e-6;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
}
static void ball(dem_world *w, double x, double y, double z) {
    const double c[3] = {x, y, z};
    assert_int_equal(dem_add_spheres(w, 1, c, &size, 0, 0), DEM_OK);
}
/* Three spheres in an angle. */
static void clump_at(dem_world *w, double x, double y, double z) {
    const double c[9] = {0, 0, 0, 0.003, 0, 0, 0, 0.002, 0}, d[3] = {0.004, 0.004, 0.003}, at[3] = {x, y, z};
    dem_clump clump;
    assert_int_equal(dem_make_clump(3, c, d, &clump), DEM_OK);
    assert_int_equal(dem_add_clumps(w, 1, &clump, at, NULL, NULL, 0, 0), DEM_OK);
}
static void brick_at(dem_world *w, double x, double y, double z) {
    const double at[3] = {x, y, z};
    dem_convex shape;
    assert_int_equal(dem_make_brick(&shape, v3(0.004, 0.005, 0.006), 0.1, NULL), DEM_OK);
    assert_int_equal(dem_add_convex(w, dem_add_shape(w, &shape), 1, at, NULL, 0, 0), DEM_OK);
}
static double in_play(const dem_energy_ledger *l) { return l->kinetic + l->rotational + l->elastic + l->removed; }

/* ---- links ---- */

/* A bond: it pulls the gap to 0, resists slip as a spring and as a dashpot, and twist by a torque. It
   tears at a gap. */
enum { STIFF, LIMIT, DRAG, TWIST, STATES };
DEM_INLINE void bond_force(const dem_contact *c, double *state, dem_response *r) {
    r->normal = -state[STIFF] * c->gap + state[DRAG] * c->closing;
    for (int a = 0; a < 3; a++) r->tangential[a] = -state[DRAG] * c->slip[a];
    for (int a = 0; a < 3; a++) r->rolling[a] = -state[TWIST] * c->spin[a];
    r->ended = c->gap > state[LIMIT] ? 1.0 : 0.0;
}
DEM_INLINE void stiffer_force(const dem_contact *c, double *state, dem_response *r) {
    bond_force(c, state, r);
    r->normal *= 3.0;
}
static const dem_law bond = {"bond", 1, STATES, 0, 0, 0, NULL, bond_force, NULL, NULL};
static const dem_law stiffer = {"bond, stiffer", 1, STATES, 0, 0, 0, NULL, stiffer_force, NULL, NULL};
DEM_LINK_KERNEL(bond_kernel, bond)
DEM_LINK_KERNEL(stiffer_kernel, stiffer)

enum {
    NOTHING,
    LINK_ADDED,
    LINK_TO_WALL,
    LAW_REPLACED,
    LAW_OFF,
    INTERVAL_HALVED,
    INTERVAL_LONGER,
    NEAR_CHANGED,
    STEP_CHANGED,
    GRAVITY_CHANGED,
    STRUCK,
    LOADED,
    HELD,
    LET_GO,
    REMOVED,
    TURNED,
    WALL_MOVED,
    WALL_OFF,
    RELOADED,
    LEDGER_BEGINS,
    LEDGER_PAUSED,
    LINK_ACTS
};
static const char *const link_acts[LINK_ACTS] = {
    "nothing",      "link added",   "link to a wall",  "law replaced", "law off",  "shorter",       "longer",
    "near changed", "step changed", "gravity changed", "struck",       "loaded",   "held",          "let go",
    "removed",      "turned",       "wall moved",      "wall off",     "reloaded", "ledger begins", "ledger paused"};
static void none_force(const dem_contact *c, double *state, dem_response *r) { (void)c, (void)state, (void)r; }
static const dem_law none = {"bond, none", 1, STATES, 0, 0, 0, NULL, none_force, NULL, NULL};
DEM_LINK_KERNEL(none_kernel, none)

static void act_on_links(dem_world *w, int act, int plane, int features) {
    const double state[STATES] = {3.0, 1.0, 1e-4, 1e-9};
    const ptrdiff_t other = w->count - 1;
    dem_status status = DEM_OK;
    switch (act) {
    case LINK_ADDED: status = dem_add_link(w, 0, other, 0, state); break;
    case LINK_TO_WALL: status = dem_add_link(w, other, -1 - plane, 0, state); break;
    case LAW_REPLACED: status = dem_set_links(w, &stiffer_kernel, interval, 0.0); break;
    case LAW_OFF: status = dem_set_links(w, &none_kernel, interval, 0.0); break;
    case INTERVAL_HALVED: status = dem_set_links(w, &bond_kernel, 0.5 * interval, 0.0); break;
    case INTERVAL_LONGER: status = dem_set_links(w, &bond_kernel, 1.7 * interval, 0.0); break;
    case NEAR_CHANGED: status = dem_set_links(w, &bond_kernel, interval, 1e-6); break;
    case STEP_CHANGED: status = dem_set_time_step(w, 0.37e-6); break;
    case GRAVITY_CHANGED: status = dem_set_gravity(w, v3(3.0, 0, -9.81)); break;
    case STRUCK: status = dem_set_motion(w, 0, v3(0.1, 0.2, -0.1), v3(30, -20, 10)); break;
    case LOADED: status = dem_set_load(w, 0, v3(1e-3, 0, -2e-3), v3(0, 1e-6, 0)); break;
    case HELD: status = dem_fix(w, 0, 1); break;
    case LET_GO:
        assert_int_equal(dem_fix(w, 0, 1), DEM_OK);
        run(w, 3.3 * interval, features);
        status = dem_fix(w, 0, 0);
        break;
    case REMOVED: status = dem_remove(w, 0); break;
    case TURNED: {
        const dem_quaternion turn = {0.8, 0.2, -0.5, 0.3};
        if (dem_get_body(w, 0).pieces > 1) status = dem_set_orientation(w, 0, turn);
        break;
    }
    case WALL_MOVED: status = dem_move(w, plane, v3(0.05, 0, 0.02)); break;
    case WALL_OFF: status = dem_enable_wall(w, plane, 0); break;
    case RELOADED: reload(w), status = dem_set_links(w, &bond_kernel, interval, 0.0); break;
    case LEDGER_PAUSED: run(w, 2.6 * interval, features & ~DEM_ENERGY); break;
    default: break;
    }
    assert_int_equal(status, DEM_OK);
}

/* A chain of three, of spheres or with a clump at its end, and a tie to a wall; acts between two
   evaluations and at one. */
static void test_acts_on_links(void **state) {
    (void)state;
    const double soft[STATES] = {2.0, 0.01, 1e-4, 1e-9};
    for (int k = 0; k < 4 * LINK_ACTS; k++) {
        const int act = k / 4, has_clump = k & 1, between = k >> 1 & 1,
                  features = DEM_LINEAR | DEM_FRICTION | DEM_ENERGY;
        const ptrdiff_t second = has_clump ? 3 : 1;
        char what[80];
        dem_world w;
        make(&w, 0.5, v3(0, 0, -1.0));
        const int plane = dem_add_plane(&w, 0, v3(0, 0, -0.02), v3(0, 0, 1));
        if (has_clump) clump_at(&w, 0, 0, 0);
        else ball(&w, 0, 0, 0);
        ball(&w, 0.009, 0.001, 0), ball(&w, 0.015, 0, 0.001);
        assert_int_equal(dem_set_links(&w, &bond_kernel, interval, 0.0), DEM_OK);
        assert_int_equal(dem_add_link(&w, 0, second, 0, soft), DEM_OK);
        assert_int_equal(dem_add_link(&w, second, second + 1, 0, soft), DEM_OK);
        if (act == WALL_MOVED || act == WALL_OFF) assert_int_equal(dem_add_link(&w, 0, -1 - plane, 0, soft), DEM_OK);
        assert_int_equal(dem_set_motion(&w, 0, v3(-0.1, 0.2, 0.05), v3(20, -10, 30)), DEM_OK);
        assert_int_equal(dem_set_motion(&w, second, v3(0.1, 0.1, 0), v3(-50, 20, 0)), DEM_OK);
        run(&w, (40.0 + 0.4 * between) * interval, act == LEDGER_BEGINS ? features & ~DEM_ENERGY : features);
        act_on_links(&w, act, plane, features);
        for (int part = 0; part < 5; part++) {
            run(&w, (part + 0.3) * interval, features);
            const dem_energy_ledger l = dem_energy(&w);
            snprintf(what, sizeof what, "%s%s%s, part %d", link_acts[act], has_clump ? ", clump" : "",
                     between ? ", between" : "", part);
            assert_true(in_play(&l) > 1e-7);
            /* a clump's arms turn between two evaluations */
            near_absolute(l.error / in_play(&l), 0.0, has_clump ? 1e-4 : 1e-9, what);
        }
        dem_free(&w);
    }
}

/* A link that tears, and one whose particles pass an exit. */
static void test_links_that_end(void **state) {
    (void)state;
    const double weak[STATES] = {2.0, 0.0055, 1e-4, 1e-9};
    for (int leaves = 0; leaves < 2; leaves++) {
        const int features = DEM_LINEAR | DEM_FRICTION | DEM_ENERGY;
        dem_world w;
        make(&w, 0.5, v3(0, 0, -1.0));
        if (leaves) dem_add_exit(&w, v3(0.0102, 0, 0), v3(-1, 0, 0));
        ball(&w, 0, 0, 0), ball(&w, 0.009, 0, 0);
        assert_int_equal(dem_set_links(&w, &bond_kernel, interval, 0.0), DEM_OK);
        assert_int_equal(dem_add_link(&w, 0, 1, 0, weak), DEM_OK);
        assert_int_equal(dem_set_motion(&w, 1, v3(0.5, 0.1, 0), v3(0, 30, 10)), DEM_OK);
        for (int part = 0; part < 40; part++) {
            run(&w, 7.3 * interval, features);
            const dem_energy_ledger l = dem_energy(&w);
            near_absolute(l.error / in_play(&l), 0.0, 1e-9, leaves ? "leaves" : "tears");
        }
        assert_int_equal(dem_link_count(&w), 0);
        dem_free(&w);
    }
}

/* ---- force fields ---- */

/* A field that turns around an axis and drags. */
typedef struct swirl {
    double push, drag; /* [N/m], [kg/s] */
} swirl;
DEM_INLINE dem_vec swirl_force(const dem_force_point *at) {
    const swirl *s = (const swirl *)at->user;
    return dem_vec3(-s->push * at->position.y - s->drag * at->velocity.x,
                    s->push * at->position.x - s->drag * at->velocity.y, -s->drag * at->velocity.z);
}
DEM_FORCE_FIELD(swirl_field, swirl_force)

enum {
    FIELD_AS_IT_WAS,
    FIELD_SET,
    FIELD_REMOVED,
    FIELD_CHANGED,
    FIELD_FINER,
    IN_FIELD_GRAVITY,
    IN_FIELD_STEP,
    IN_FIELD_STRUCK,
    IN_FIELD_LOADED,
    IN_FIELD_HELD,
    IN_FIELD_LET_GO,
    IN_FIELD_REMOVED,
    IN_FIELD_TURNED,
    IN_FIELD_OVERLAPPED,
    IN_FIELD_WALL_OFF,
    IN_FIELD_WALL_MOVED,
    IN_FIELD_STIFFER,
    IN_FIELD_RELOADED,
    IN_FIELD_BEGINS,
    IN_FIELD_PAUSED,
    FIELD_ACTS
};
static const swirl weak = {1e-3, 2e-4}, strong = {-4e-3, 1e-3};
static dem_force_field field_of(const swirl *s) {
    dem_force_field f = dem_default_force_field(swirl_field, s);
    f.accuracy = 1e-8;
    return f;
}
static void act_in_field(dem_world *w, int act, int features) {
    dem_force_field f = field_of(&strong), same = field_of(&weak);
    dem_pair_def p = *dem_pair(&w->def, 0, 0);
    dem_status status = DEM_OK;
    switch (act) {
    case FIELD_SET:
    case FIELD_CHANGED: status = dem_set_force_field(w, &f); break;
    case FIELD_REMOVED: status = dem_set_force_field(w, NULL); break;
    case FIELD_FINER: same.accuracy = 1e-10, same.interval = 1e-4, status = dem_set_force_field(w, &same); break;
    case IN_FIELD_GRAVITY: status = dem_set_gravity(w, v3(3.0, 0, -20)); break;
    case IN_FIELD_STEP: status = dem_set_time_step(w, 0.37e-6); break;
    case IN_FIELD_STRUCK: status = dem_set_motion(w, 0, v3(0.1, 0.2, -0.3), v3(10, 30, 0)); break;
    case IN_FIELD_LOADED: status = dem_set_load(w, 0, v3(1e-3, 0, -2e-3), v3(0, 1e-6, 0)); break;
    case IN_FIELD_HELD: status = dem_fix(w, 0, 1); break;
    case IN_FIELD_LET_GO:
        assert_int_equal(dem_fix(w, 0, 1), DEM_OK);
        run(w, 1e-4, features);
        status = dem_fix(w, 0, 0);
        break;
    case IN_FIELD_REMOVED: status = dem_remove(w, 0); break;
    case IN_FIELD_TURNED: {
        const dem_quaternion turn = {0.8, 0.2, -0.5, 0.3};
        if (dem_set_orientation(w, 0, turn) != DEM_OK) assert_int_equal(dem_get_body(w, 0).pieces, 1);
        break;
    }
    case IN_FIELD_OVERLAPPED: {
        const dem_vec x = dem_position(w, 0);
        ball(w, x.x + 0.0001, x.y, x.z + dem_radius(w, 0) + 0.0018);
        break;
    }
    case IN_FIELD_WALL_OFF: status = dem_enable_wall(w, 0, 0); break;
    case IN_FIELD_WALL_MOVED: status = dem_move(w, 0, v3(0.1, 0, 0.1)); break;
    case IN_FIELD_STIFFER: p.stiffness *= 2.0, status = dem_set_pair(w, 0, 0, &p); break;
    case IN_FIELD_RELOADED: reload(w), status = dem_set_force_field(w, &same); break;
    case IN_FIELD_PAUSED: run(w, 1.3e-4, features & ~DEM_ENERGY); break;
    default: break;
    }
    assert_int_equal(status, DEM_OK);
}

/* A sphere, a clump, a brick: in flight far from the floor, or pressed into it. */
static void test_acts_in_fields(void **state) {
    (void)state;
    const int features = DEM_LINEAR | DEM_FRICTION | DEM_ENERGY;
    for (int k = 0; k < 6 * FIELD_ACTS; k++) {
        const int act = k / 6, shape = k % 3, touches = k % 6 / 3;
        const double height = touches ? (shape == 0 ? 0.002 : shape == 1 ? 0.002 : 0.003) + 1e-6 : 0.5;
        char what[80];
        dem_world w;
        dem_force_field f = field_of(&weak);
        make(&w, 0.5, v3(0, 0, -9.81));
        dem_add_plane(&w, 0, v3(0, 0, 0), v3(0, 0, 1));
        if (shape == 0) ball(&w, 0.01, 0, height);
        else if (shape == 1) clump_at(&w, 0.01, 0, height);
        else brick_at(&w, 0.01, 0, height);
        if (act != FIELD_SET) assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        assert_int_equal(dem_set_motion(&w, 0, v3(0.05, 0.1, -0.2), v3(0, 3, 2)), DEM_OK);
        run(&w, touches ? 2.3e-4 : 3.33e-3, act == IN_FIELD_BEGINS ? features & ~DEM_ENERGY : features);
        if (touches) assert_true(dem_contact_count(&w) > 0);
        act_in_field(&w, act, features);
        run(&w, 4e-3, features);
        const dem_energy_ledger l = dem_energy(&w);
        const double scale = in_play(&l) + fabs(l.field_work);
        snprintf(what, sizeof what, "act %d, shape %d%s", act, shape, touches ? ", pressed" : "");
        near_absolute(l.error / scale, 0.0, touches || act == IN_FIELD_OVERLAPPED ? 2e-3 : 1e-6, what);
        dem_free(&w);
    }
}

/* A sphere, a clump, a brick that was removed in mid-flight: no later act books its motion again. */
static void test_removed_in_field(void **state) {
    (void)state;
    static const int act[] = {IN_FIELD_GRAVITY, IN_FIELD_STEP, FIELD_CHANGED, FIELD_REMOVED};
    const int features = DEM_LINEAR | DEM_FRICTION | DEM_ENERGY;
    for (int k = 0; k < 3 * (int)(sizeof act / sizeof *act); k++) {
        const int shape = k % 3;
        char what[80];
        dem_world w;
        dem_force_field f = field_of(&weak);
        f.accuracy = 1e-4; /* long flights, whose parabolas are far from their true velocities */
        make(&w, 0.5, v3(0, 0, -9.81));
        if (shape == 0) ball(&w, 0.01, 0, 0.5);
        else if (shape == 1) clump_at(&w, 0.01, 0, 0.5);
        else brick_at(&w, 0.01, 0, 0.5);
        assert_int_equal(dem_set_force_field(&w, &f), DEM_OK);
        assert_int_equal(dem_set_motion(&w, 0, v3(0.05, 0.1, -0.2), v3(0, 3, 2)), DEM_OK);
        run(&w, 3.33e-3, features);
        assert_int_equal(dem_remove(&w, 0), DEM_OK);
        const double work = dem_energy(&w).field_work;
        assert_true(work != 0.0);
        act_in_field(&w, act[k / 3], features);
        snprintf(what, sizeof what, "removed, act %d, shape %d", act[k / 3], shape);
        near_absolute(dem_energy(&w).field_work, work, 0.0, what);
        dem_free(&w);
    }
}

/* ---- the order of sums ---- */

/* A tide, in which the work of all often changes its sign: only where a sum is small do its bits show its order. */
DEM_INLINE dem_vec tide_force(const dem_force_point *at) {
    return dem_vec3(at->mass * 10.0 * riddle_cos(2000.0 * at->time), 0.0, 0.0);
}
DEM_FORCE_FIELD(tide_field, tide_force)

enum { IN_FIELD, AROUND_FIXED, DOWN_A_SLOPE, CROWDS };

/* A crowd that collides: in a field, around fixed spheres that move, or through the ends of a periodic box. */
static void crowd(dem_world *w, int kind, int features, int reloads) {
    enum { SIDE = 4 };
    const double apart = 0.008;
    const dem_force_field f = dem_default_force_field(tide_field, NULL);
    uint32_t draw = 7;
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 2500.0, 1e7, 0.2);
    dem_pair_def *p = dem_pair(&def, m, m);
    p->restitution = 0.9, p->stiffness = 500.0, p->friction = 0.3;
    def.gravity = kind == DOWN_A_SLOPE ? v3(5, 0, -8) : v3(0, 0, 0), def.dt = 1e-5;
    def.low = v3(0, 0, 0), def.high = v3(SIDE * apart, SIDE * apart, SIDE * apart);
    for (int a = 0; a < 3; a++) def.periodic[a] = kind == DOWN_A_SLOPE;
    assert_int_equal(dem_init(w, &def, NULL), DEM_OK);
    if (kind != DOWN_A_SLOPE) dem_add_box(w, 0, def.low, def.high);
    for (int k = 0; k < SIDE * SIDE * SIDE; k++) {
        const int fixed = kind == AROUND_FIXED && k % 5 == 0;
        const double speed = fixed ? 0.02 : 1.0;
        double v[3];
        for (int a = 0; a < 3; a++)
            draw = draw * 1664525u + 1013904223u, v[a] = speed * ((double)(draw >> 8) / 16777216.0 - 0.5);
        ball(w, (0.5 + k % SIDE) * apart, (0.5 + k / SIDE % SIDE) * apart, (0.5 + k / SIDE / SIDE) * apart);
        if (fixed) assert_int_equal(dem_fix(w, k, 1), DEM_OK);
        assert_int_equal(dem_set_motion(w, k, v3(v[0], v[1], v[2]), v3(0, 0, 0)), DEM_OK);
    }
    if (kind == IN_FIELD) assert_int_equal(dem_set_force_field(w, &f), DEM_OK);
    run(w, 0.01, features);
    if (reloads) reload(w);
    if (kind == IN_FIELD && reloads) assert_int_equal(dem_set_force_field(w, &f), DEM_OK);
    run(w, 0.08, features);
}

/* No bit of the books depends on when lists are built. */
static void test_order_of_sums(void **state) {
    (void)state;
    const int features = DEM_LINEAR | DEM_FRICTION | DEM_ENERGY;
    for (int kind = 0; kind < CROWDS; kind++) {
        dem_world w, other;
        crowd(&w, kind, features, 0), crowd(&other, kind, features, 1);
        assert_true(dem_hash(&other) == dem_hash(&w));
        const dem_energy_ledger l = dem_energy(&w), of_other = dem_energy(&other);
        const double *sum = &l.kinetic, *its = &of_other.kinetic;
        assert_true((kind == IN_FIELD ? l.field_work : kind == AROUND_FIXED ? l.external_work : l.added) != 0.0);
        for (int k = 0; k < (int)(sizeof l / sizeof *sum); k++) {
            char what[60];
            snprintf(what, sizeof what, "crowd %d, number %d", kind, k);
            near_absolute(its[k], sum[k], 0.0, what);
        }
        dem_free(&w), dem_free(&other);
    }
}

/* ---- a bed of bricks that is struck ---- */

/* The points of a face's edges come and go with the bodies' places: neither their friction nor their damping leaves
   a remainder. */
static void test_struck_bed(void **state) {
    (void)state;
    const double apart = 0.011;
    double c[3 * 27];
    dem_world w;
    dem_convex s;
    dem_def def = dem_default_def();
    const int m = dem_add_material(&def, 2500.0, 1e7, 0.2), features = DEM_LINEAR | DEM_FRICTION | DEM_ENERGY;
    dem_pair_def *p = dem_pair(&def, m, m);
    p->stiffness = 2e4, p->restitution = 0.5, p->friction = 0.5;
    def.dt = 2e-6;
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    for (int k = 0; k < 2; k++) dem_add_plane(&w, m, v3(0.02 * k, 0, 0), v3(0, 0, 1)); /* flush: both act */
    for (int k = -1; k < 2; k += 2) {
        dem_add_plane(&w, m, v3(0.02 * k, 0, 0), v3(-k, 0, 0));
        dem_add_plane(&w, m, v3(0, 0.02 * k, 0), v3(0, -k, 0));
    }
    assert_int_equal(dem_make_brick(&s, v3(0.008, 0.006, 0.005), 0.05, NULL), DEM_OK);
    for (int n = 0; n < 27; n++) {
        const int layer = n / 9;
        c[3 * n] = -0.012 + apart * (n % 3) + 0.001 * layer, c[3 * n + 1] = -0.011 + 0.01 * (n / 3 % 3);
        c[3 * n + 2] = 0.006 + 0.009 * layer;
    }
    assert_int_equal(dem_add_convex(&w, dem_add_shape(&w, &s), 27, c, NULL, m, 0), DEM_OK);
    run(&w, 0.12, features);
    const dem_energy_ledger before = dem_energy(&w);
    assert_int_equal(dem_set_motion(&w, 13, v3(0.3, 0.2, -0.22), v3(0, 0, 0)), DEM_OK);
    const double struck = dem_energy(&w).added - before.added;
    run(&w, 0.02, features);
    const dem_energy_ledger l = dem_energy(&w);
    assert_int_equal(dem_core_overlaps(&w), 0);
    print_message("struck with %.2e J: error of settling %.1e J of %.1e J, of the stroke %.1e J\n", struck,
                  before.error, before.released, l.error - before.error);
    near_absolute(before.error, 0.0, 3e-3 * before.released, "settling");
    near_absolute(l.error - before.error, 0.0, 0.01 * struck, "the stroke");
    dem_free(&w);
}

/* ---- walls that turn ---- */

/* Bodies in a drum or a box that turns, against rolling resistance: the ledger has the work that the wall counts, which
   is its torque times its angle, and closes. */
static void test_work_against_rolling_resistance(void **state) {
    (void)state;
    void (*const add[3])(dem_world *, double, double, double) = {ball, clump_at, brick_at};
    for (int k = 0; k < 6; k++) {
        dem_world w;
        make(&w, 0.5, v3(0, 0, -9.81));
        dem_pair_def pair = w.def.pair[0][0];
        pair.restitution = 0.5, pair.rolling = 2e-4;
        assert_int_equal(dem_set_pair(&w, 0, 0, &pair), DEM_OK);
        assert_int_equal(dem_set_time_step(&w, 1e-5), DEM_OK);
        const int wall = k < 3 ? dem_add_cylinder(&w, 0, v3(0, 0, 0), v3(0, 1, 0), 0.02, 1)
                               : dem_add_box(&w, 0, v3(-0.015, -0.01, -0.015), v3(0.015, 0.01, 0.015));
        assert_true(wall == 0);
        dem_add_plane(&w, 0, v3(0, -0.01, 0), v3(0, 1, 0)), dem_add_plane(&w, 0, v3(0, 0.01, 0), v3(0, -1, 0));
        assert_int_equal(dem_rotate(&w, wall, v3(0, 0, 0), v3(0, 1, 0), 12.0), DEM_OK);
        for (int i = 0; i < 6; i++) add[k % 3](&w, 0.007 * (i % 3 - 1), 0.001 * (i % 3), i < 3 ? -0.006 : 0.005);
        run(&w, 0.15, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY);
        const dem_energy_ledger l = dem_energy(&w);
        const double work = w.wall[wall].work;
        near_relative(work, -12.0 * dem_wall_angular_impulse(&w, wall, v3(0, 0, 0)).y, 1e-9, "work = torque x angle");
        near_relative(l.wall_work, work, 1e-3, "work in the ledger");
        near_absolute(l.error, 0.0, 6e-3 * work, "error of the ledger");
        dem_free(&w);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_acts_on_links),
        cmocka_unit_test(test_links_that_end),
        cmocka_unit_test(test_acts_in_fields),
        cmocka_unit_test(test_removed_in_field),
        cmocka_unit_test(test_order_of_sums),
        cmocka_unit_test(test_struck_bed),
        cmocka_unit_test(test_work_against_rolling_resistance),
    };
    return cmocka_run_group_tests_name("ledger", tests, NULL, NULL);
}
