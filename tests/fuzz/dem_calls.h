/* dem_calls.h: one public call of dem.h with numbers that are drawn beforehand, so that several worlds can be given
   the same one. */
#ifndef RIDDLE_FUZZ_DEM_CALLS_H
#define RIDDLE_FUZZ_DEM_CALLS_H

#include "../dem_changes.h"
#include "../dem_scenes.h"
#include "../failing_allocator.h"
#include "programs.h"

#define HALF 0.015    /* of the part of space where things are put [m] */
#define SMALLEST 2e-3 /* diameter [m] */
#define LARGEST 6e-3
#define MOST_SPHERES 48 /* that a program has at a time, about: no more are asked for */

/* ---- laws of a host's own: one with other states and with hooks, and one for links ---- */

static const dem_law spring = {"spring", 1, SPRING_STATES, 0, 0, 0, NULL, scene_spring_force, NULL, NULL};
DEM_LINK_KERNEL(spring_kernel, spring)

static void try_to_change(dem_world *w) {
    const int accepted = dem_first_accepted(w, dem__kernel_linear(), &spring_kernel);
    if (fuzz_traces && accepted >= 0) fprintf(stderr, "call %d of a hook is not refused\n", accepted);
    FUZZ_HOLDS(accepted < 0);
}

enum { STICKY_STATES = 5 };
DEM_INLINE void sticky_force(const dem_contact *c, double *state, dem_response *r) {
    dem_force_linear_friction(c, state, r);
    state[3] += c->dt; /* age of the contact [s] */
    r->normal -= 1e-4;
}
static void sticky_born(dem_world *w, const int32_t *slots, ptrdiff_t n, void *user) {
    (void)user;
    for (ptrdiff_t k = 0; k < n; k++) {
        dem_contact_info c = dem_get_contact(w, slots[k]);
        c.state[4] = (double)w->id[c.i];
        dem_set_contact_state(w, slots[k], c.state);
    }
    try_to_change(w);
}
static void sticky_ended(dem_world *w, int32_t slot, void *user) {
    (void)user;
    FUZZ_HOLDS(dem_get_contact(w, slot).state[3] >= 0.0);
    try_to_change(w);
}
static const dem_law sticky = {"sticky",     1,           STICKY_STATES, 4, 1, DEM_LINEAR_CONSTANTS, dem_prepare_linear,
                               sticky_force, sticky_born, sticky_ended};
DEM_KERNEL(sticky_kernel, sticky, DEM_LINEAR | DEM_FRICTION)

static void swing(void *user, double time, dem_pose *pose) {
    (void)user;
    pose->shift = dem_vec3(1e-3 * riddle_sin(300.0 * time), 0.0, 2e-3 * riddle_sin(200.0 * time));
    pose->turn = dem_vec3(0.1 * riddle_sin(100.0 * time), 0.0, 2.0 * time);
}

/* ---- calls ---- */

enum {
    ADD_SPHERES,
    SET_MOTION,
    SET_LOAD,
    REMOVE,
    REMOVE_REGION,
    FILL,
    FILL_MASS,
    FEED_NUMBER,
    FEED_MASS,
    TAKE_PASSED,
    ADD_PLANE,
    ADD_CYLINDER,
    ADD_SPHERE_WALL,
    ADD_CONE,
    ADD_DISC,
    ADD_SCREEN,
    ADD_BOX,
    ADD_MESH,
    ADD_EXIT,
    VIBRATE,
    MOVE,
    ROTATE,
    PRESCRIBE,
    CONTROL_FORCE,
    CONTROL_TORQUE,
    SET_BELT,
    ENABLE_WALL,
    SET_GRAVITY,
    SET_PAIR,
    SET_TIME_STEP,
    SET_LINKS,
    ADD_LINK,
    RUN,
    RUN_LAW,
    OLD_CALLS, /* from here on: bodies, fields, and what concerns walls' groups and insides */
    ADD_CLUMPS = OLD_CALLS,
    ADD_SHAPE,
    ADD_CONVEX,
    SET_ORIENTATION,
    SET_FIELD,
    SET_SOLID,
    SET_WALL_GROUPS,
    MIDDLE_CALLS, /* from here on: what is fixed, states of contacts, threads, meshes from files */
    FIX = MIDDLE_CALLS,
    SET_CONTACT_STATE,
    SET_THREADS,
    REMOVE_IN_MESH,
    FILL_IN_MESH,
    ADD_MESH_SHAPE,
    CALLS
};

enum { NUMBERS = 16, PICKS = 4 };
typedef struct call {
    int kind;
    double u[NUMBERS]; /* uniform in 0 .. 1 */
    int pick[PICKS];   /* any non-negative number */
    int odd;           /* that number is `value` instead; NUMBERS + k: pick k is -1 - pick; -1: none */
    double value;
    int most_steps; /* of a run */
} call;

static call draw_call(fuzz_draws *d, int kind, int hostile) {
    call c;
    c.kind = kind;
    for (int k = 0; k < NUMBERS; k++) c.u[k] = fuzz_uniform(d);
    for (int k = 0; k < PICKS; k++) c.pick[k] = fuzz_one_of(d, 1 << 20);
    c.odd = -1, c.value = 0.0, c.most_steps = 1500;
    if (hostile) c.odd = fuzz_one_of(d, NUMBERS + PICKS), c.value = fuzz_hostile_number(d);
    return c;
}

/* Number k of a call, between low and high if it is not an odd one. */
static double number(const call *c, int k, double low, double high) {
    return c->odd == k ? c->value : low + (high - low) * c->u[k];
}
/* The same, evenly in its logarithm. */
static double decade(const call *c, int k, double low, double high) {
    return c->odd == k ? c->value : low * riddle_exp(riddle_log(high / low) * c->u[k]);
}
static dem_vec vector(const call *c, int k, double size) {
    dem_vec v;
    v.x = number(c, k, -size, size), v.y = number(c, k + 1, -size, size), v.z = number(c, k + 2, -size, size);
    return v;
}
/* One of n, or in an odd call none of them. */
static int pick(const call *c, int k, int n) {
    return c->odd == NUMBERS + k ? (c->pick[k] % 2 ? -1 - c->pick[k] : n + c->pick[k]) : n > 0 ? c->pick[k] % n : 0;
}

/* A world with what its host keeps beside it. */
typedef struct side {
    dem_world w;
    failing_allocator memory;
    dem_feed feed;
    int threads, backwards; /* given again after loading */
    int most_threads;       /* that it has had */
    int links;              /* have they a law? */
    double interval, near;
    int bodies; /* may the feeds have clumps (1), polyhedra (2), and compounds (3)? */
    dem_clump clump;
    dem_compound compound;
    dem_gas gas;
    dem_force_field field; /* without a kernel: none is set */
} side;

/* The array index of the sphere picked among those present: a save closes the gaps of those that are gone. -1:
   there is none. */
static ptrdiff_t sphere(const side *s, const call *c, int k) {
    ptrdiff_t present = 0;
    for (ptrdiff_t i = 0; i < s->w.count; i++) present += s->w.alive[i] == DEM_PRESENT;
    if (c->odd == NUMBERS + k) return c->pick[k] % 2 ? -1 - c->pick[k] : s->w.count + c->pick[k];
    ptrdiff_t nth = present ? c->pick[k] % present : -1;
    for (ptrdiff_t i = 0; i < s->w.count && present; i++) {
        if (s->w.alive[i] == DEM_PRESENT && nth-- == 0) return i;
    }
    return -1;
}
static ptrdiff_t spheres_present(const dem_world *w) {
    ptrdiff_t n = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) n += w->alive[i] == DEM_PRESENT;
    return n;
}

static dem_region region_of(const call *c) {
    const dem_vec x = vector(c, 0, HALF);
    const double size = number(c, 3, 0.0, HALF);
    switch (pick(c, 0, 3)) {
    case 0: return dem_sphere_region(x, size);
    case 1: return dem_cylinder_region(x, vector(c, 4, 1.0), size, number(c, 7, 0.0, HALF));
    default:
        return dem_box_region(x, dem_vec3(x.x + size, x.y + number(c, 7, 0.0, HALF), x.z + number(c, 8, 0.0, HALF)));
    }
}

static dem_sizes sizes_of(const call *c) {
    const double largest = number(c, 9, 3e-3, LARGEST), smallest = number(c, 10, 1.0, 3e-3 / SMALLEST) * SMALLEST;
    const double list[3] = {largest, smallest, number(c, 11, SMALLEST, LARGEST)},
                 share[3] = {1.0, number(c, 12, 0.0, 1.0), 0.5};
    switch (pick(c, 1, 5)) {
    case 0: return dem_one_size(largest);
    case 1: return dem_size_list(3, list, share, c->pick[2] % 2);
    case 2: return dem_uniform_sizes(smallest, largest, c->pick[2] % 2);
    case 3:
        return dem_lognormal_sizes(number(c, 11, SMALLEST, LARGEST), number(c, 12, 0.1, 1.0), smallest, largest,
                                   c->pick[2] % 2);
    default:
        return dem_rosin_rammler_sizes(number(c, 11, SMALLEST, LARGEST), number(c, 12, 0.5, 8.0), smallest, largest,
                                       c->pick[2] % 2);
    }
}

static int shapes_of(const dem_world *w) {
    int n = 0;
    while (dem_get_shape(w, n)) n++;
    return n;
}
static void set_feed(side *s, const call *c) {
    dem_feed *feed = &s->feed;
    feed->clump = s->bodies && c->pick[0] % 4 == 3 ? &s->clump : NULL;
    /* There is one from the beginning. */
    feed->polyhedron = s->bodies > 1 && c->pick[0] % 4 < 2 ? 1 + pick(c, 1, shapes_of(&s->w)) : 0;
    /* with a polyhedron beside it the feed is refused */
    feed->compound = s->bodies > 2 && c->pick[0] % 8 < (c->odd == NUMBERS ? 2 : 1) ? &s->compound : NULL;
    if (feed->compound && c->odd != NUMBERS) feed->polyhedron = 0;
    feed->region = region_of(c);
    feed->sizes = sizes_of(c);
    feed->material = c->pick[3] % 2;
    feed->velocity = dem_vec3(0.0, 0.0, number(c, 13, -0.3, 0.0));
    feed->scatter = dem_vec3(number(c, 14, 0.0, 0.2), 0.1, 0.0);
    feed->tries = 50;
}

static int add_mesh(dem_world *w, const call *c) {
    enum { CORNERS = 4, FACES = 4 };
    static const int32_t closed[3 * FACES] = {0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2};
    double vertex[3 * CORNERS];
    int32_t triangle[3 * FACES];
    dem_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    for (int k = 0; k < 3 * CORNERS; k++) vertex[k] = number(c, k, -HALF, HALF);
    memcpy(triangle, closed, sizeof closed);
    triangle[c->pick[1] % (3 * FACES)] = pick(c, 2, CORNERS);
    mesh.vertices = CORNERS, mesh.vertex = vertex, mesh.triangles = 1 + c->pick[3] % FACES, mesh.triangle = triangle;
    return dem_add_mesh(w, pick(c, 0, 2), &mesh);
}

static int add_wall(dem_world *w, const call *c) {
    const dem_vec x = vector(c, 0, HALF), n = vector(c, 3, 1.0);
    const double size = number(c, 6, 2e-3, HALF);
    const int material = pick(c, 0, 2);
    dem_screen screen = dem_default_screen();
    dem_cone cone = dem_default_cone();
    dem_disc disc = dem_default_disc();
    switch (c->kind) {
    case ADD_PLANE: return dem_add_plane(w, material, x, n);
    case ADD_CYLINDER: return dem_add_cylinder(w, material, x, n, size, c->pick[1] % 2);
    case ADD_SPHERE_WALL: return dem_add_sphere_wall(w, material, x, size, c->pick[1] % 2);
    case ADD_EXIT: return dem_add_exit(w, dem__scale(HALF, n), dem__scale(-1.0, n));
    case ADD_MESH: return add_mesh(w, c);
    case ADD_BOX:
        return dem_add_box(w, material, x,
                           dem_vec3(x.x + size, x.y + number(c, 7, 1e-3, HALF), x.z + number(c, 8, 1e-3, HALF)));
    case ADD_CONE:
        cone.low = x, cone.high = vector(c, 7, HALF), cone.low_radius = size,
        cone.high_radius = number(c, 10, 0.0, HALF);
        return dem_add_cone(w, material, &cone);
    case ADD_DISC:
        disc.centre = x, disc.normal = n, disc.radius = size, disc.hole_radius = number(c, 10, 0.0, size);
        return dem_add_disc(w, material, &disc);
    default:
        screen.aperture = number(c, 7, 2e-3, 8e-3), screen.wire = number(c, 8, 1e-3, 3e-3);
        screen.half_x = size, screen.half_y = number(c, 9, 5e-3, HALF), screen.circular = c->pick[1] % 2;
        screen.profile = c->pick[2] % 2 ? DEM_ROUND : DEM_SEMICIRCLE;
        screen.centre = x, screen.normal = n, screen.direction = vector(c, 10, 1.0);
        return dem_add_screen(w, material, &screen);
    }
}

static dem_status move_wall(dem_world *w, const call *c) {
    const int wall = pick(c, 0, w->walls);
    const dem_vec centre = vector(c, 0, HALF), axis = vector(c, 3, 1.0), small = vector(c, 6, 5e-4);
    switch (c->kind) {
    case VIBRATE: return dem_vibrate(w, wall, small, vector(c, 9, 3.0), number(c, 12, 0.0, 80.0));
    case MOVE: return dem_move(w, wall, vector(c, 6, 0.2));
    case ROTATE: return dem_rotate(w, wall, centre, axis, number(c, 6, -10.0, 10.0));
    case PRESCRIBE: return dem_prescribe(w, wall, centre, swing, NULL);
    case CONTROL_FORCE:
        return dem_control_force(w, wall, axis, decade(c, 6, 1e-2, 1.0), number(c, 7, -0.5, 0.5),
                                 number(c, 8, 0.0, 1.0));
    case CONTROL_TORQUE:
        return dem_control_torque(w, wall, centre, axis, decade(c, 6, 1e-6, 1e-4), number(c, 7, -1e-4, 1e-4),
                                  number(c, 8, 0.0, 1e-4));
    case SET_BELT: return dem_set_belt(w, wall, vector(c, 6, 0.3));
    default: return dem_enable_wall(w, wall, c->pick[1] % 2);
    }
}

/* Some spheres anywhere: in walls, in each other, on one point. */
static dem_status add_spheres(dem_world *w, const call *c) {
    const int n = 1 + c->pick[1] % 5;
    double centre[15], diameter[5];
    for (int k = 0; k < n; k++) {
        const int same = k > 0 && c->pick[2] % 7 == 0;
        for (int a = 0; a < 3; a++)
            centre[3 * k + a] = same ? centre[a] : number(c, (3 * k + a) % 12, -HALF, HALF) * (a == k % 3 ? -1.0 : 1.0);
        diameter[k] = number(c, 12 + k % 3, SMALLEST, LARGEST);
    }
    return dem_add_spheres(w, n, centre, diameter, pick(c, 0, 2), c->pick[3] % 3);
}

static dem_status set_pair(dem_world *w, const call *c) {
    dem_pair_def p = *dem_pair(&w->def, 0, 0);
    p.stiffness = decade(c, 0, 200.0, 1000.0), p.tangential_ratio = number(c, 1, 0.0, 1.0),
    p.restitution = number(c, 2, 0.2, 1.0);
    p.friction = number(c, 3, 0.0, 1.0), p.rolling = number(c, 4, 0.0, 1e-4),
    p.tangential_damping = number(c, 5, 0.0, 0.5);
    p.mode = (dem_restitution)pick(c, 2, 2);
    return dem_set_pair(w, pick(c, 0, 2), pick(c, 1, 2), &p);
}

static dem_status set_links(side *s, const call *c) {
    const double interval = decade(c, 0, 5e-6, 1e-4), near = c->pick[0] % 2 ? 0.0 : number(c, 1, 0.0, 1e-6);
    const dem_status status = dem_set_links(&s->w, &spring_kernel, interval, near);
    if (status == DEM_OK) s->links = 1, s->interval = interval, s->near = near;
    return status;
}
static dem_status add_link(side *s, const call *c) {
    const double state[SPRING_STATES] = {number(c, 0, 0.0, 2.0), number(c, 1, 1e-3, 8e-3), number(c, 2, 0.0, 1e-3)};
    const ptrdiff_t i = sphere(s, c, 0),
                    j = c->pick[2] % 4 && s->w.walls ? sphere(s, c, 1) : -1 - pick(c, 1, s->w.walls);
    return dem_add_link(&s->w, i, j, 0, state);
}

/* ---- bodies and fields ---- */

static dem_status add_clumps(dem_world *w, const call *c) {
    const int n = 1 + c->pick[1] % 2, of = 2 + c->pick[2] % 3;
    double centre[12], diameter[4], at[6], size[2], turn[8];
    dem_clump clump;
    for (int k = 0; k < of; k++) {
        for (int a = 0; a < 3; a++)
            centre[3 * k + a] = number(c, (k + 3 * a) % 7, -2e-3, 2e-3) * (a == k % 3 ? -1.0 : 1.0);
        diameter[k] = number(c, 7 + k % 2, SMALLEST, 4e-3);
    }
    const dem_status made = dem_make_clump(of, centre, diameter, &clump);
    if (made != DEM_OK) return made;
    dem_clump_diameter(&clump);
    for (int k = 0; k < n; k++) {
        for (int a = 0; a < 3; a++) at[3 * k + a] = number(c, 9 + (k + a) % 3, -HALF, HALF) * (a == k ? -1.0 : 1.0);
        for (int a = 0; a < 4; a++) turn[4 * k + a] = number(c, 12 + (k + a) % 4, -1.0, 1.0);
        size[k] = number(c, 8, 3e-3, LARGEST);
    }
    return dem_add_clumps(w, n, &clump, at, c->pick[3] % 2 ? size : NULL, c->pick[3] % 3 ? turn : NULL, pick(c, 0, 2),
                          c->pick[3] % 40);
}

static dem_status add_shape(dem_world *w, const call *c) {
    enum { CORNERS = 6 };
    double corner[3 * CORNERS];
    dem_convex shape;
    const char *reason = NULL;
    const double rounding = number(c, 3, 0.02, 0.2);
    dem_status made;
    if (c->pick[0] % 2) {
        made = dem_make_brick(&shape,
                              dem_vec3(number(c, 0, 2e-3, 6e-3), number(c, 1, 2e-3, 4e-3), number(c, 2, 2e-3, 4e-3)),
                              rounding, &reason);
    } else { /* an octahedron, pulled about */
        for (int k = 0; k < 3 * CORNERS; k++) corner[k] = 5e-4 * (c->u[k % NUMBERS] - 0.5);
        for (int k = 0; k < CORNERS; k++)
            corner[4 * k % (3 * CORNERS)] += (k % 2 ? 1.0 : -1.0) * number(c, 4 + k, 1.5e-3, 3e-3);
        made = dem_make_convex(&shape, 4 + c->pick[1] % 3, corner, rounding, &reason);
    }
    FUZZ_HOLDS((made == DEM_OK) == (reason == NULL));
    if (made != DEM_OK || shapes_of(w) > 3) return made;
    const int added = dem_add_shape(w, &shape);
    return added >= 0 ? DEM_OK : (dem_status)-added;
}
static dem_status add_convex(dem_world *w, const call *c) {
    const int n = 1 + c->pick[1] % 3;
    double at[9], turn[12];
    for (int k = 0; k < n; k++) {
        for (int a = 0; a < 3; a++) at[3 * k + a] = number(c, 3 * k + a, -HALF, HALF);
        for (int a = 0; a < 4; a++) turn[4 * k + a] = number(c, 9 + (k + a) % 7, -1.0, 1.0);
    }
    return dem_add_convex(w, pick(c, 1, shapes_of(w)), n, at, c->pick[2] % 3 ? turn : NULL, pick(c, 0, 2),
                          c->pick[3] % 40);
}

DEM_INLINE dem_vec in_a_bowl(const dem_force_point *at) {
    const dem_vec pull = dem__scale(-40.0 * at->mass, at->position);
    return at->position.x > 0.0 ? pull : dem_vec3(0, 0, 0);
}
DEM_FORCE_FIELD(bowl, in_a_bowl)
DEM_GAS(air, dem_drag_schiller_naumann)
DEM_GAS(thick_air, dem_drag_stokes)

/* 2 x 2 x 2 velocities */
static const double gas_grid[24] = {1, 0, 0, 0, 2, 0, 0, 0, 3, -1, 0, 0, 0, -2, 0, 0, 0, -3, 2, 2, 0, 0, 1, 1};

/* The field of s, that of another side or one set before, for its own world. */
static dem_status hand_over_field(side *s) {
    if (s->field.user) s->field.user = &s->gas;
    return dem_set_force_field(&s->w, &s->field);
}
static dem_status set_field(side *s, const call *c) {
    const side before = *s;
    if (c->pick[0] % 3 == 0) {
        s->field.kernel = NULL;
        return dem_set_force_field(&s->w, NULL);
    }
    s->gas = dem_default_gas();
    s->gas.density = decade(c, 0, 0.5, 50.0), s->gas.viscosity = decade(c, 1, 1e-5, 1e-3),
    s->gas.buoyancy = c->pick[1] % 2;
    if (c->pick[1] % 3) {
        for (int a = 0; a < 3; a++) s->gas.n[a] = 2;
        s->gas.low = dem_vec3(-HALF, -HALF, number(c, 2, -HALF, 0.0)),
        s->gas.high = dem_vec3(HALF, HALF, number(c, 3, 1e-3, HALF));
        s->gas.velocity = gas_grid, s->gas.pressure_gradient = c->pick[2] % 2 ? gas_grid : NULL;
        s->gas.spin = number(c, 4, -50.0, 50.0), s->gas.axis = vector(c, 5, 1.0), s->gas.centre = vector(c, 8, HALF);
        if (c->pick[2] % 3 == 0) dem_attach_gas(&s->gas, &s->w, pick(c, 3, s->w.walls));
    }
    s->field = c->pick[0] % 3 == 1 ? dem_default_force_field(bowl, NULL)
                                   : dem_gas_field(c->pick[3] % 2 ? air : thick_air, &s->gas);
    s->field.accuracy = decade(c, 11, 1e-8, 1e-4);
    if (s->field.kernel == bowl) s->field.length = 1e-3; /* it begins at x = 0, which a longer step could miss */
    if (c->odd == 12) s->field.length = c->value;
    if (c->odd == 13) s->field.interval = c->value;
    const dem_status status =
        dem_check_gas(&s->gas, NULL) == DEM_OK ? dem_set_force_field(&s->w, &s->field) : DEM_BAD_ARGUMENT;
    if (status != DEM_OK) s->gas = before.gas, s->field = before.field;
    return status;
}

static dem_quaternion turn_of(const call *c) {
    dem_quaternion q;
    q.w = number(c, 0, -1.0, 1.0), q.x = number(c, 1, -1.0, 1.0), q.y = number(c, 2, -1.0, 1.0),
    q.z = number(c, 3, -1.0, 1.0);
    return q;
}

/* ---- what is fixed, states of contacts, meshes from files ---- */

static dem_status set_contact_state(dem_world *w, const call *c) {
    const ptrdiff_t n = dem_contact_count(w);
    if (n == 0) return DEM_OK;
    dem_contact_info info = dem_get_contact(w, c->pick[0] % n);
    for (int k = 0; k < DEM_STATE_MAX; k++) info.state[k] *= c->u[k];
    dem_set_contact_state(w, c->pick[0] % n, info.state);
    return DEM_OK;
}

/* A tetrahedron as an STL file, read: closed unless an odd pick leaves faces out. The caller frees it. */
static dem_status read_tetrahedron(const call *c, dem_mesh *mesh) {
    enum { HEAD = 84, FACET = 50, FACES = 4 };
    static const int corner[FACES][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    unsigned char bytes[HEAD + FACES * FACET];
    float vertex[4][3];
    dem_stl_report report;
    memset(bytes, 0, sizeof bytes);
    for (int k = 0; k < 4; k++) {
        for (int a = 0; a < 3; a++)
            vertex[k][a] = (float)(number(c, 3 * k + a, -2e-3, 2e-3) + (k == a + 1 ? 5e-3 : 0.0));
    }
    bytes[80] = FACES;
    for (int f = 0; f < FACES; f++) {
        for (int k = 0; k < 3; k++) memcpy(bytes + HEAD + f * FACET + 12 + 12 * k, vertex[corner[f][k]], 12);
    }
    const size_t size = c->odd == NUMBERS + 1 ? sizeof bytes - (size_t)(c->pick[1] % 150) : sizeof bytes;
    return dem_read_stl(bytes, size, 1.0, number(c, 12, 0.0, 1e-6), NULL, mesh, &report);
}
static dem_status use_tetrahedron(side *s, const call *c) {
    dem_world *w = &s->w;
    dem_mesh mesh;
    dem_status status = read_tetrahedron(c, &mesh);
    if (status != DEM_OK) return DEM_BAD_ARGUMENT; /* no file that could be read */
    const dem_region region = dem_mesh_region(&mesh);
    if (c->kind == REMOVE_IN_MESH) {
        const ptrdiff_t n = dem_remove_region(w, &region);
        status = n < 0 ? (dem_status)-n : DEM_OK;
    } else if (c->kind == FILL_IN_MESH) {
        dem_feed feed = s->feed;
        feed.region = region;
        status = dem_fill(w, &feed, c->pick[3] % 4);
        feed.region = s->feed.region;
        s->feed = feed;
    } else {
        dem_convex shape;
        status = dem_make_convex_mesh(&shape, &mesh, number(c, 13, 0.02, 0.2), NULL);
        const int added = status == DEM_OK && shapes_of(w) < 4 ? dem_add_shape(w, &shape) : 0;
        if (added < 0) status = (dem_status)-added;
    }
    dem_free_mesh(&mesh);
    return status;
}

static dem_status apply_new_call(side *s, const call *c) {
    dem_world *w = &s->w;
    switch (c->kind) {
    case FIX: return dem_fix(w, sphere(s, c, 0), c->odd == NUMBERS + 1 ? c->pick[1] : c->pick[1] % 3 > 0);
    case SET_CONTACT_STATE: return set_contact_state(w, c);
    case SET_THREADS:
        s->threads = w->def.threads = 1 + c->pick[0] % 3;
        s->most_threads = s->threads > s->most_threads ? s->threads : s->most_threads;
        return DEM_OK;
    case REMOVE_IN_MESH:
    case FILL_IN_MESH:
    case ADD_MESH_SHAPE: return use_tetrahedron(s, c);
    case ADD_CLUMPS: return add_clumps(w, c);
    case ADD_SHAPE: return add_shape(w, c);
    case ADD_CONVEX: return add_convex(w, c);
    case SET_ORIENTATION: return dem_set_orientation(w, sphere(s, c, 0), turn_of(c));
    case SET_FIELD: return set_field(s, c);
    case SET_SOLID: return dem_set_solid(w, pick(c, 0, w->walls), c->odd == NUMBERS + 1 ? c->pick[1] : c->pick[1] % 2);
    default: return dem_set_wall_groups(w, pick(c, 0, w->walls), (uint32_t)c->pick[1] * 2654435761u);
    }
}

/* ---- a call ---- */

static dem_status run_for(dem_world *w, double duration, int features, int own_law) {
    return own_law ? dem_run_law(w, duration, &sticky_kernel) : dem_run(w, duration, features);
}

static int features_of(const call *c) {
    static const int named[] = {DEM_LINEAR, DEM_LINEAR | DEM_FRICTION, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING,
                                DEM_HERTZ,  DEM_HERTZ | DEM_FRICTION,  DEM_HERTZ | DEM_FRICTION | DEM_ROLLING};
    if (c->odd == NUMBERS) return c->pick[0];
    return named[c->pick[0] % 6] | (c->pick[1] % 2 ? DEM_ENERGY : 0);
}
/* 1e-4 .. 1e-2 s, or an odd one; but of a legal one no more steps than a program has time for. */
static double duration_of(const side *s, const call *c) {
    const double wanted = decade(c, 0, 1e-4, 1e-2), most = c->most_steps * s->w.def.dt;
    return wanted > most && wanted < 1e16 * s->w.def.dt ? most : wanted;
}

static dem_status apply_call(side *s, const call *c) {
    dem_world *w = &s->w;
    if (c->kind >= ADD_PLANE && c->kind <= ADD_EXIT) {
        const int wall = add_wall(w, c);
        return wall >= 0 ? DEM_OK : (dem_status)-wall;
    }
    if (c->kind >= VIBRATE && c->kind <= ENABLE_WALL) return move_wall(w, c);
    if (c->kind >= FILL && c->kind <= FEED_MASS) set_feed(s, c);
    if (c->kind >= OLD_CALLS) return apply_new_call(s, c);
    const dem_region region = region_of(c);
    ptrdiff_t n = 0;
    switch (c->kind) {
    case ADD_SPHERES: return add_spheres(w, c);
    case SET_MOTION: return dem_set_motion(w, sphere(s, c, 0), vector(c, 0, 0.3), vector(c, 3, 50.0));
    case SET_LOAD: return dem_set_load(w, sphere(s, c, 0), vector(c, 0, 1e-3), vector(c, 3, 1e-7));
    case REMOVE: return dem_remove(w, sphere(s, c, 0));
    case REMOVE_REGION: n = dem_remove_region(w, &region); break;
    case FILL:
        return dem_fill(w, &s->feed, c->odd == NUMBERS + 3 ? (c->pick[3] % 2 ? -1 : PTRDIFF_MAX / 2) : c->pick[3] % 12);
    case FILL_MASS: return dem_fill_mass(w, &s->feed, number(c, 15, 0.0, 4e-4));
    case FEED_NUMBER: return dem_feed_number(w, &s->feed, number(c, 15, 0.0, 1e3), 5e-3);
    case FEED_MASS: return dem_feed_mass(w, &s->feed, number(c, 15, 0.0, 0.1), 5e-3);
    case TAKE_PASSED: n = dem_take_passed(w, NULL, pick(c, 0, 100)); break;
    case SET_GRAVITY: return dem_set_gravity(w, vector(c, 0, 20.0));
    case SET_PAIR: return set_pair(w, c);
    case SET_TIME_STEP: return dem_set_time_step(w, decade(c, 0, 2e-6, 6e-6));
    case SET_LINKS: return set_links(s, c);
    case ADD_LINK: return add_link(s, c);
    default: return run_for(w, duration_of(s, c), features_of(c), c->kind == RUN_LAW);
    }
    return n >= 0 ? DEM_OK : (dem_status)-n;
}

#endif
