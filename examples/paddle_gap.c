/* paddle_gap - one interspace of a deflector wheel: how often particles meet the paddles and each other, and how fast
   (Weers et al. 2022).

   Two paddles turn in the inertial frame, and the gas between them turns with them. Particles enter over the free arc
   at the wheel's rim, as many as the loading says, with the radial and tangential velocities of classifier.h, and are
   followed until they leave outward or inward. In flight each takes steps of its own, chosen by its error; only where
   it touches does it take those of a contact. What the histories give, contacts by particle and restitution, goes into
   the separation model of classifier.h. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "classifier.h"
#include "common.h"
#include "csv.h"
#include "dem.h"

enum { BINS = 12, NODES_X = 43, NODES_Y = 45, NODES_MAX = 1 << 20, SIZES_MAX = DEM_SIZES_MAX, MEETINGS = 8 };
enum { BRICK, SPHERE, CLUMP, BOTH }; /* --shape */
static const char *const shapes[] = {"brick", "sphere", "clump", "both"};
static const double margin = 3e-4;   /* beyond the rim a particle has left [m] */
static const double interval = 2e-6; /* of feeding and removing [s] */
static const double steps_a_contact = 50.0;
static const double brick_step = 0.05; /* between the sizes of bricks: of the logarithm [-] */

typedef struct gap {
    int shape, drag, particles;
    double restitution, rpm, depth, smallest, longest, warm, loading, contact_time, median, spread;
    double least; /* approach over the rim's speed from which a contact counts [-] */
    const char *sizes_file, *field_file;
    bool one_rate;
    const program *self;
    classifier_def machine;
    dem_sizes sizes;
    double simulated; /* share of the solids' mass that is larger than the smallest simulated [-] */
    dem_clump clump;
    int first_brick, bricks; /* shapes of the world */
    int springs;             /* among how many corners of a brick a pair's spring is divided */
} gap;

/* Another particle, or paddle (-1 - wall), that a particle touches at some points. */
typedef struct meeting {
    ptrdiff_t with;
    int points;
} meeting;

/* What is known of a particle by its id. */
typedef struct history {
    double size, entered, left;   /* [m], [s]; left: NaN inside */
    double hit_radius, hit_speed; /* of the first hit on the paddle behind [m], against it along its
                                     normal [m/s]; NaN: none */
    double along, across;         /* velocity of its centre against the paddle that it strikes, when this began [m/s] */
    int struck, disturbed;        /* that paddle + 1, until it is clear of it; whether it touched others meanwhile */
    meeting met[MEETINGS];
    int followed, paddle, mates, again; /* contacts with paddles, with particles; with the one in front */
    int outward;
} history;

typedef struct record {
    const gap *g;
    history *of;
    ptrdiff_t n, room;
    double restitution_sum, restitution_square;
    double turned_sum, turned_square; /* angle between rebound and mirrored approach [rad] */
    ptrdiff_t rebounds;
    int64_t overlaps; /* of cores, or of a core and a paddle: the most that were seen at a time */
} record;

static double omega(const gap *g) { return g->rpm * RIDDLE_PI / 30.0; }
static double pitch(const gap *g) { return 2.0 * RIDDLE_PI / g->machine.wheel.paddles; }

/* ---- contacts: a spring whose contact time is the same for all sizes; each beginning is counted ---- */

static double prepare(const dem_birth *birth, double *constants) {
    const gap *g = birth->user ? ((const record *)birth->user)->g : NULL;
    dem_birth b = *birth;
    dem_pair_def pair = *birth->pair;
    const double damping = log(pair.restitution), t = g ? g->contact_time : 1e-7;
    pair.stiffness = (g ? g->springs : 1.0) * b.mass * (RIDDLE_PI * RIDDLE_PI + damping * damping) / (t * t);
    b.pair = &pair;
    return dem_prepare_linear(&b, constants);
}

/* Number of a particle's history: all parts of a clump have one. */
static int parts(const gap *g) { return g->shape == CLUMP ? g->clump.spheres : 1; }
static ptrdiff_t history_of(const dem_world *w, const gap *g, ptrdiff_t i) { return (ptrdiff_t)w->id[i] / parts(g); }
/* Radius of the sphere about a particle of size d [m]. */
static double reach(const gap *g, int shape, double d) {
    if (shape == BRICK) return 0.5 * d * cbrt(RIDDLE_PI / 6.0 / 2.08) * sqrt(2.0 + 2.08 * 2.08);
    return shape == CLUMP ? 2.0 * g->clump.radius[0] * d / dem_clump_diameter(&g->clump) : 0.5 * d;
}
static dem_vec minus(dem_vec a, dem_vec b) { return dem_vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
static double dot(dem_vec a, dem_vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* Velocity of a body's centre against a paddle, along it and across it [m/s], and its distance from the
   paddle's middle [m]. */
static void seen_from(const dem_world *w, const gap *g, const dem_body *p, int wall, double *along, double *across,
                      double *distance) {
    const dem_vec a = w->wall[wall].axis[0], b = w->wall[wall].axis[1];
    const double turn = wall * pitch(g), c = cos(turn), s = sin(turn), spin = w->wall[wall].spin;
    const dem_vec line = dem_vec3(c * a.x + s * b.x, c * a.y + s * b.y, 0.0), normal = dem_vec3(-line.y, line.x, 0.0);
    const dem_vec v = dem_vec3(p->velocity.x + spin * p->position.y, p->velocity.y - spin * p->position.x, 0.0);
    *along = dot(v, line), *across = dot(v, normal), *distance = fabs(dot(p->position, normal));
}

/* Velocity of particle i where it touches [m/s]. */
static dem_vec surface_velocity(const dem_world *w, const gap *g, ptrdiff_t i, dem_vec point) {
    const dem_vec v = w->particle[i].v, s = w->particle[i].spin;
    dem_vec arm = minus(point, w->particle[i].x);
    arm.z -= g->depth * floor(arm.z / g->depth + 0.5);
    return dem_vec3(v.x + s.y * arm.z - s.z * arm.y, v.y + s.z * arm.x - s.x * arm.z, v.z + s.x * arm.y - s.y * arm.x);
}

/* Velocity with which the surfaces approach at a contact [m/s]. */
static double closing(const dem_world *w, const gap *g, const dem_contact_info *c) {
    const dem_vec u = surface_velocity(w, g, c->i, c->point), p = c->point;
    const double spin = c->j < 0 ? w->wall[-1 - c->j].spin : 0.0;
    const dem_vec v = c->j < 0 ? dem_vec3(-spin * p.y, spin * p.x, 0.0) : surface_velocity(w, g, c->j, p);
    return -dot(minus(u, v), c->normal);
}

/* Where a particle keeps what it touches at `with`, or a free place; NULL if all are taken. */
static meeting *meeting_with(history *h, ptrdiff_t with) {
    meeting *place = NULL;
    for (int k = 0; k < MEETINGS; k++) {
        if (h->met[k].points > 0 && h->met[k].with == with) return &h->met[k];
        if (h->met[k].points == 0) place = &h->met[k];
    }
    return place;
}
static int touches(const history *h) {
    int n = 0;
    for (int k = 0; k < MEETINGS; k++) n += h->met[k].points;
    return n;
}

/* Particle i begins to touch a paddle. */
static void strikes(const dem_world *w, const gap *g, history *h, ptrdiff_t i, int wall, int counts, int alone) {
    const dem_body body = dem_get_body(w, i);
    double along, across, distance;
    seen_from(w, g, &body, wall, &along, &across, &distance);
    if (h->struck == 0) h->struck = wall + 1, h->along = along, h->across = across, h->disturbed = !alone;
    if (!counts) return;
    h->paddle++, h->again += wall == 1;
    if (wall == 1 || !isnan(h->hit_radius)) return;
    h->hit_radius = hypot(body.position.x, body.position.y);
    h->hit_speed = fabs(across);
}

/* A point of contact begins. A contact lasts from its first point to its last; it counts if the first one
   begins fast. */
static void begins(dem_world *w, const int32_t *numbers, ptrdiff_t n, void *user) {
    record *r = user;
    const double least = r->g->least * omega(r->g) * r->g->machine.wheel.outer_radius;
    for (ptrdiff_t k = 0; k < n; k++) {
        const dem_contact_info c = dem_get_contact(w, numbers[k]);
        const ptrdiff_t with = c.j < 0 ? c.j : history_of(w, r->g, c.j);
        history *a = &r->of[history_of(w, r->g, c.i)];
        const int alone = touches(a) == 0;
        meeting *met = meeting_with(a, with);
        if (!met) continue;
        met->with = with;
        if (met->points++ > 0) continue;
        const int counts = closing(w, r->g, &c) >= least;
        if (with < 0) {
            strikes(w, r->g, a, c.i, (int)(-1 - with), counts, alone);
            continue;
        }
        a->mates += counts, r->of[with].mates += counts;
        a->disturbed = r->of[with].disturbed = 1;
    }
}

static void ends(dem_world *w, int32_t number, void *user) {
    record *r = user;
    const dem_contact_info c = dem_get_contact(w, number);
    meeting *met = meeting_with(&r->of[history_of(w, r->g, c.i)], c.j < 0 ? c.j : history_of(w, r->g, c.j));
    if (met && met->points > 0) met->points--;
}

/* A particle that has struck a paddle and is clear of it: a rebound, unless it touched others meanwhile. A brick may
   strike twice. */
static void rebounds(const dem_world *w, record *r, history *h, const dem_body *body) {
    const gap *g = r->g;
    double along, across, distance;
    if (h->struck == 0 || touches(h) > 0) return;
    seen_from(w, g, body, h->struck - 1, &along, &across, &distance);
    const double around = g->shape == CLUMP ? reach(g, CLUMP, h->size) : dem_radius(w, body->first);
    if (!(distance > 0.5 * g->machine.wheel.thickness + around)) return;
    h->struck = 0;
    if (h->disturbed || !(fabs(h->across) >= g->least * omega(g) * g->machine.wheel.outer_radius)) return;
    const double e = -across / h->across, turned = atan2(along, e * fabs(h->across)) - atan2(h->along, fabs(h->across));
    r->restitution_sum += e, r->restitution_square += e * e, r->rebounds++;
    r->turned_sum += turned, r->turned_square += turned * turned;
}

static const dem_law counted = {"linear, friction, one contact time, counted",
                                1,
                                3,
                                3,
                                1,
                                DEM_LINEAR_CONSTANTS,
                                prepare,
                                dem_force_linear_friction,
                                begins,
                                ends};
DEM_KERNEL(counting, counted, DEM_LINEAR | DEM_FRICTION)

DEM_GAS(air_drag, dem_drag_schiller_naumann)

/* ---- the gas between the paddles ---- */

/* The stand-in for the measured field: seen from the wheel, inward as the passage between the paddles narrows. */
static double *analytic_field(const gap *g, dem_gas *gas) {
    const classifier_wheel *wheel = &g->machine.wheel;
    double *u = malloc(sizeof *u * 3 * 2 * NODES_X * NODES_Y);
    gas->low = dem_vec3(16e-3, -2e-3, -1.0), gas->high = dem_vec3(26.5e-3, 9e-3, 1.0);
    gas->n[0] = NODES_X, gas->n[1] = NODES_Y, gas->n[2] = 2;
    for (int k = 0; u && k < 2 * NODES_X * NODES_Y; k++) {
        const double x = gas->low.x + (gas->high.x - gas->low.x) * (k % NODES_X) / (NODES_X - 1);
        const double y = gas->low.y + (gas->high.y - gas->low.y) * (k / NODES_X % NODES_Y) / (NODES_Y - 1),
                     r = hypot(x, y);
        const double within = r < wheel->outer_radius ? wheel->paddles * wheel->thickness : 0.0;
        const double in = g->machine.air_flow / (wheel->height * (2.0 * RIDDLE_PI * r - within));
        u[3 * k] = -in * x / r, u[3 * k + 1] = -in * y / r, u[3 * k + 2] = 0.0;
    }
    return u;
}

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}
/* The different values of a column, increasing and evenly spaced; how many, or 0. */
static int axis_of(const csv_data *data, int column, double factor, double *value) {
    int n = 0;
    for (int k = 0; k < data->rows; k++) value[k] = factor * data->values[k * data->columns + column];
    qsort(value, (size_t)data->rows, sizeof *value, compare);
    for (int k = 0; k < data->rows; k++) {
        if (n == 0 || value[k] - value[n - 1] > 1e-9) value[n++] = value[k];
    }
    for (int k = 0; k < n; k++) {
        if (!(fabs(value[k] - value[0] - (value[n - 1] - value[0]) * k / (n - 1)) <
              1e-6 * fabs(value[n - 1] - value[0])))
            return 0;
    }
    return n > 1 ? n : 0;
}

/* A field of the user's: x_m, y_m in the wheel's frame, the paddle behind along x; u_m_s, v_m_s as seen
   from the wheel. */
static double *field_of_file(const gap *g, dem_gas *gas) {
    static const char *const names[4] = {"x_m", "y_m", "u_m_s", "v_m_s"};
    csv_data data;
    char message[400];
    int column[4];
    double factor[4], *u = NULL;
    if (csv_read(g->field_file, &data, message, sizeof message))
        program_refuse(g->self, "field", g->field_file, message);
    for (int k = 0; k < 4; k++) {
        column[k] = csv_find(&data, names[k], &factor[k], message, sizeof message);
        if (column[k] < 0) program_refuse(g->self, "field", g->field_file, message);
    }
    double *x = malloc(sizeof *x * 2 * (size_t)(data.rows + 1)), *y = x + data.rows + 1;
    const int nx = x ? axis_of(&data, column[0], factor[0], x) : 0,
              ny = x ? axis_of(&data, column[1], factor[1], y) : 0;
    if (nx == 0 || ny == 0 || (long)nx * ny != data.rows || nx > NODES_MAX / ny)
        program_refuse(g->self, "field", g->field_file, "every node of an evenly spaced grid in x and y once");
    gas->low = dem_vec3(x[0], y[0], -1.0), gas->high = dem_vec3(x[nx - 1], y[ny - 1], 1.0);
    gas->n[0] = nx, gas->n[1] = ny, gas->n[2] = 2;
    u = calloc((size_t)nx * (size_t)ny * 6, sizeof *u);
    for (int k = 0; u && k < data.rows; k++) {
        const double *row = data.values + k * data.columns;
        const int i = (int)floor((factor[0] * row[column[0]] - x[0]) / (x[nx - 1] - x[0]) * (nx - 1) + 0.5);
        const int j = (int)floor((factor[1] * row[column[1]] - y[0]) / (y[ny - 1] - y[0]) * (ny - 1) + 0.5);
        for (int layer = 0; layer < 2; layer++) {
            double *at = u + 3 * ((ptrdiff_t)(layer * ny + j) * nx + i);
            at[0] = factor[2] * row[column[2]], at[1] = factor[3] * row[column[3]];
            if (!isfinite(at[0]) || !isfinite(at[1]))
                program_refuse(g->self, "field", g->field_file, "finite velocities");
        }
    }
    free(x);
    csv_free(&data);
    return u;
}

/* ---- sizes ---- */

/* Mass of a lognormal law above a size [-]. */
static double mass_above(const gap *g, double size) {
    return 0.5 * erfc(log(size / g->median) / (g->spread * sqrt(2.0)));
}

/* The stand-in, or from a file: size_m, and share, of mass. Shares of what is not simulated leave with it. */
static void choose_sizes(gap *g) {
    char message[600];
    sheet_sizes data;
    double d[SIZES_MAX], share[SIZES_MAX], all = 0.0, kept = 0.0;
    int n = 0;
    if (!g->sizes_file) {
        g->sizes = dem_lognormal_sizes(g->median, g->spread, g->smallest, 180e-6, 1);
        g->simulated = (mass_above(g, g->smallest) - mass_above(g, 180e-6)) / (1.0 - mass_above(g, 180e-6));
        return;
    }
    if (sheet_read_sizes(g->sizes_file, NULL, 1, &data, message, sizeof message))
        program_refuse(g->self, "sizes", g->sizes_file, message);
    if (!data.single && (data.amount[0][0] > 1e-3 || data.above[0] > 1e-3))
        program_refuse(g->self, "sizes", g->sizes_file,
                       "a curve from 0 to 1: its first size passes nothing, its last one everything");
    common_print("%s\n", data.how);
    for (int k = data.single ? 0 : 1; k < data.n; k++) {
        const double x = data.single ? data.size[k] : sqrt(data.size[k - 1] * data.size[k]);
        const double m = data.amount[0][k] - (data.single ? 0.0 : data.amount[0][k - 1]);
        if (!(x > 0.0 && x <= 1e-3) || !(m >= 0.0 && isfinite(m)) || n == SIZES_MAX)
            program_refuse(g->self, "sizes", g->sizes_file,
                           "at most 32 sizes above 0 up to 1000 um, shares of mass >= 0");
        all += m;
        if (x < g->smallest) continue;
        d[n] = x, share[n++] = m, kept += m;
    }
    sheet_free_sizes(&data);
    if (!(kept > 0.0)) program_refuse(g->self, "sizes", g->sizes_file, "some mass above --x-min-um");
    g->sizes = dem_size_list(n, d, share, 1);
    g->simulated = kept / all;
}
static double largest(const gap *g) {
    double most = g->sizes.largest;
    for (int k = 0; k < g->sizes.count; k++) most = fmax(most, g->sizes.diameter[k]);
    return most;
}

/* ---- the scene ---- */

/* A paddle at an angle [rad], through the whole slice and beyond it. Its index, or minus a status. */
static int add_paddle(dem_world *w, const gap *g, double angle) {
    static int32_t corner[36] = {0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 3, 7, 1, 7, 5};
    double vertex[24];
    const classifier_wheel *wheel = &g->machine.wheel;
    for (int k = 0; k < 8; k++) {
        const double along = k & 1 ? wheel->outer_radius : wheel->inner_radius,
                     across = (k & 2 ? 0.5 : -0.5) * wheel->thickness;
        vertex[3 * k] = along * cos(angle) - across * sin(angle),
                   vertex[3 * k + 1] = along * sin(angle) + across * cos(angle);
        vertex[3 * k + 2] = k & 4 ? 2.0 * g->depth : -g->depth;
    }
    dem_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.vertices = 8, mesh.vertex = vertex, mesh.triangles = 12, mesh.triangle = corner;
    return dem_add_mesh(w, 1, &mesh);
}

/* The paper's bricks, 1 : 1 : 2.08, of sizes that lie close together. */
static dem_status add_bricks(dem_world *w, gap *g) {
    g->bricks = 1 + (int)ceil(log(largest(g) / g->smallest) / brick_step);
    for (int k = 0; k < g->bricks; k++) {
        dem_convex brick;
        const double a = g->smallest * exp(brick_step * k) * cbrt(RIDDLE_PI / 6.0 / 2.08);
        const dem_status status = dem_make_brick(&brick, dem_vec3(a, a, 2.08 * a), 0.03, NULL);
        const int number = status == DEM_OK ? dem_add_shape(w, &brick) : -(int)status;
        if (number < 0) return (dem_status)-number;
        if (k == 0) g->first_brick = number;
        g->springs = brick.springs; /* spheres among bricks, too: so a contact of spheres lasts half as long */
    }
    return DEM_OK;
}

static dem_status build(dem_world *w, gap *g) {
    dem_def def = dem_default_def();
    def.allocator.fn = machine_resize;
    dem_add_material(&def, g->machine.particle_density, 1e9, 0.2);
    dem_add_material(&def, 7800.0, 2e11, 0.3);
    for (int k = 0; k < 2; k++) {
        dem_pair_def *p = dem_pair(&def, 0, k);
        p->restitution = g->restitution, p->friction = 0.8, p->tangential_ratio = k ? 0.78 : 0.86;
    }
    def.dt = g->contact_time / steps_a_contact;
    def.threads = g->self->threads;
    def.skin = 1.0;
    def.gravity = dem_vec3(0, 0, 0); /* 9.8 of 2e4 m/s2 */
    def.periodic[2] = 1;
    def.low = dem_vec3(0, 0, 0), def.high = dem_vec3(1, 1, g->depth);
    dem_status status = dem_init(w, &def, NULL);
    g->springs = 1;
    if (status == DEM_OK && (g->shape == BRICK || g->shape == BOTH)) status = add_bricks(w, g);
    for (int k = 0; k < 2 && status == DEM_OK; k++) {
        const int wall = add_paddle(w, g, k * pitch(g));
        if (wall < 0) return (dem_status)-wall;
        status = dem_rotate(w, wall, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), omega(g));
    }
    return status;
}

/* Angle of the paddle behind now [rad]. */
static double angle_of(const dem_world *w) { return atan2(w->wall[0].axis[0].y, w->wall[0].axis[0].x); }

/* Is a place free of particles near the rim? */
static int is_free(const dem_world *w, const double *x, double r, double depth) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        const dem_vec p = dem_position(w, i);
        const double sum = r + dem_radius(w, i);
        double z = fabs(p.z - x[2]);
        z = fmin(z, depth - z);
        if ((p.x - x[0]) * (p.x - x[0]) + (p.y - x[1]) * (p.y - x[1]) + z * z < sum * sum) return 0;
    }
    return 1;
}

/* Adds a particle at x that is turned at random. The size of a brick becomes that of the nearest shape. */
static dem_status add_particle(dem_world *w, const gap *g, int shape, const double *x, double *d, uint64_t *random) {
    double q[4], square;
    if (shape == SPHERE) return dem_add_spheres(w, 1, x, d, 0, 0);
    do {
        for (int a = 0; a < 4; a++) q[a] = 2.0 * random_plain(random) - 1.0;
        square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    } while (!(square <= 1.0 && square > 1e-3));
    if (shape == CLUMP) return dem_add_clumps(w, 1, &g->clump, x, d, q, 0, 0);
    const int k = (int)floor(log(*d / g->smallest) / brick_step + 0.5), number = k < 0           ? 0
                                                                                 : k < g->bricks ? k
                                                                                                 : g->bricks - 1;
    *d = g->smallest * exp(brick_step * number);
    return dem_add_convex(w, g->first_brick + number, 1, x, q, 0, 0);
}

/* Begins the history of the particle that was added last. */
static history *new_history(record *r, double d, double time) {
    if (r->n == r->room) {
        history *more = realloc(r->of, sizeof *more * (size_t)(2 * r->room + 1024));
        if (!more) return NULL;
        r->of = more, r->room = 2 * r->room + 1024;
    }
    history *h = &r->of[r->n++];
    memset(h, 0, sizeof *h);
    h->size = d, h->entered = time, h->left = h->hit_radius = h->hit_speed = (double)NAN;
    h->followed = time >= r->g->warm;
    return h;
}

/* A new particle at the rim, as far inward as it would have come since it entered within the last interval; none if
   there is no place. */
static dem_status enter(dem_world *w, record *r, double d, uint64_t *random) {
    const gap *g = r->g;
    const classifier_wheel *wheel = &g->machine.wheel;
    const int shape = g->shape == BOTH ? (random_plain(random) < 0.5 ? BRICK : SPHERE) : g->shape;
    const double around = reach(g, shape, d);
    const double face = asin((0.5 * wheel->thickness + around) / wheel->outer_radius), arc = pitch(g) - 2.0 * face;
    const double v = classifier_distribution_at(&g->machine.radial_velocity, random_plain(random));
    const double against = classifier_distribution_at(&g->machine.tangential_velocity, random_plain(random));
    for (int tries = 0; tries < 100; tries++) {
        const double a = angle_of(w) + face + arc * random_plain(random),
                     in = wheel->outer_radius - v * interval * random_plain(random);
        const double c = cos(a), s = sin(a), x[3] = {in * c, in * s, g->depth * random_plain(random)};
        if (!is_free(w, x, around, g->depth)) continue;
        const dem_status status = add_particle(w, g, shape, x, &d, random);
        if (status != DEM_OK) return status;
        if (!new_history(r, d, w->time)) return DEM_OUT_OF_MEMORY;
        if (g->one_rate) dem_set_load(w, w->count - 1, dem_vec3(1e-30, 0, 0), dem_vec3(0, 0, 0));
        return dem_set_motion(w, w->count - 1, dem_vec3(-v * c + against * s, -v * s - against * c, 0.0),
                              dem_vec3(0, 0, 0));
    }
    return DEM_OK;
}

/* Takes out what has left: outward beyond the rim, inward beyond the paddles' inner ends. How many of those that
   are followed. */
static int leave(dem_world *w, record *r) {
    int n = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        const dem_body body = dem_get_body(w, i);
        const dem_vec p = body.position, v = body.velocity;
        if (body.first != i) continue;
        history *h = &r->of[history_of(w, r->g, i)];
        const double radius = hypot(p.x, p.y);
        rebounds(w, r, h, &body);
        const int outward = radius > r->g->machine.wheel.outer_radius + margin && p.x * v.x + p.y * v.y > 0.0;
        if (!outward && radius > r->g->machine.wheel.inner_radius) continue;
        h->left = w->time, h->outward = outward;
        n += h->followed;
        dem_remove(w, i);
    }
    return n;
}

/* Feeds and runs until as many histories are over as were asked for, or the time is. */
static dem_status run(dem_world *w, record *r) {
    const gap *g = r->g;
    const classifier_wheel *wheel = &g->machine.wheel;
    const double area = (pitch(g) * wheel->outer_radius - wheel->thickness) * g->depth;
    const double flow = g->loading * g->simulated * g->machine.fluid_density * area *
                        classifier_distribution_mean(&g->machine.radial_velocity);
    uint64_t random = g->self->seed * 0x9e3779b97f4a7c15u + 1, drawn = g->self->seed;
    double due = 0.0, waiting = dem_draw_size(&g->sizes, &drawn);
    int followed = 0, over = 0;
    dem_status status = DEM_OK;
    progress bar;
    progress_begin(&bar, "histories", g->particles);
    while (status == DEM_OK && over < g->particles && w->time < g->longest && !common_interrupted()) {
        due += flow * interval;
        for (;;) {
            const double m = RIDDLE_PI / 6.0 * g->machine.particle_density * waiting * waiting * waiting;
            if (due < 0.5 * m || status != DEM_OK) break;
            const ptrdiff_t before = r->n;
            status = enter(w, r, waiting, &random);
            if (r->n > before && r->of[r->n - 1].followed && ++followed > g->particles) r->of[r->n - 1].followed = 0;
            due -= r->n > before ? pow(r->of[before].size / waiting, 3.0) * m : m,
                waiting = dem_draw_size(&g->sizes, &drawn);
        }
        if (status == DEM_OK) status = dem_run_law(w, interval, &counting);
        if (dem_core_overlaps(w) > r->overlaps) r->overlaps = dem_core_overlaps(w);
        const int gone = leave(w, r);
        over += gone;
        progress_add(&bar, gone);
    }
    progress_end(&bar);
    return status;
}

/* ---- what came out ---- */

typedef struct sum {
    double n, mean, square;
} sum;
static void add(sum *s, double v) {
    if (isnan(v)) return;
    s->n += 1.0;
    const double off = v - s->mean;
    s->mean += off / s->n, s->square += off * (v - s->mean);
}
static double deviation(const sum *s) { return s->n > 1.0 ? sqrt(s->square / (s->n - 1.0)) : (double)NAN; }

/* The separation that follows from the contacts counted and the restitution found. */
static void separate(const gap *g, json *j, const double *share, int n, double restitution, double spread) {
    classifier_def def = g->machine;
    classifier_result result;
    classifier_model model;
    def.contacts.law = CLASSIFIER_COUNTED, def.contacts.counts = n;
    memcpy(def.contacts.share, share, sizeof *share * (size_t)n);
    def.restitution = classifier_normal(fmin(restitution, 1.0), fmax(spread, 0.01), 0.0, 1.0);
    def.particle_restitution = g->restitution;
    classifier_status status = classifier_init(&model, &def, NULL);
    if (status == CLASSIFIER_OK) status = classifier_separate(&model, NULL, NULL, 0, &result);
    if (status != CLASSIFIER_OK) common_fail("classifier: %s", classifier_status_text(status));
    else {
        common_print("separation with these contacts: x25 %.2f, x50 %.2f, x75 %.2f um, sharpness %.3f\n",
                     1e6 * result.x25, 1e6 * result.x50, 1e6 * result.x75, result.sharpness);
        results_values(j, {"x25_m", result.x25}, {"x50_m", result.x50}, {"x75_m", result.x75},
                       {"sharpness", result.sharpness});
    }
    classifier_free(&model);
}

static void report(const gap *g, const dem_world *w, const record *r) {
    sum contacts = {0, 0, 0}, paddles = {0, 0, 0}, others = {0, 0, 0}, stay = {0, 0, 0}, radius = {0, 0, 0},
        speed = {0, 0, 0}, half[2] = {{0, 0, 0}, {0, 0, 0}};
    double count[BINS] = {0}, mates[CLASSIFIER_BINS] = {0}, bin[BINS], outward = 0.0, longest = 0.0,
           *hits = malloc(sizeof *hits * (size_t)(r->n + 1));
    int n = 0, of_hits = 0, unfinished = 0;
    riddle_io_file *file =
        csv_open(g->self->out, "histories.csv",
                 "size_um,entered_ms,stayed_ms,paddle_contacts,particle_contacts,hit_radius_mm,hit_speed_m_s,outward");
    for (ptrdiff_t k = 0; k < r->n; k++) {
        const history *h = &r->of[k];
        if (!h->followed) continue;
        longest = fmax(longest, (isnan(h->left) ? w->time : h->left) - h->entered);
        if (isnan(h->left)) {
            unfinished++;
            continue;
        }
        const int all = h->paddle + h->mates;
        n++, outward += h->outward;
        add(&contacts, all), add(&paddles, h->paddle), add(&others, h->mates), add(&stay, h->left - h->entered);
        add(&half[n > (g->particles + 1) / 2], h->mates);
        add(&radius, h->hit_radius), add(&speed, h->hit_speed);
        count[all < BINS ? all : BINS - 1] += 1.0;
        mates[h->mates < CLASSIFIER_BINS ? h->mates : CLASSIFIER_BINS - 1] += 1.0;
        if (hits && !isnan(h->hit_radius)) hits[of_hits++] = h->hit_radius;
        csv_line(file, "%.3f,%.5f,%.5f,%d,%d,%.4f,%.4f,%d", 1e6 * h->size, 1e3 * h->entered,
                 1e3 * (h->left - h->entered), h->paddle, h->mates, 1e3 * h->hit_radius, h->hit_speed, h->outward);
    }
    riddle_io_close(file);
    if (n == 0) common_fail("no history is over: a longer --time-ms is needed");
    const double cor = r->restitution_sum / (double)r->rebounds,
                 cor_sd = sqrt(fmax(r->restitution_square / (double)r->rebounds - cor * cor, 0.0));
    const double turned = r->turned_sum / (double)r->rebounds,
                 turned_sd =
                     sqrt(fmax(r->turned_square / (double)r->rebounds - turned * turned, 0.0)) * 180.0 / RIDDLE_PI;
    for (int k = 0; k < BINS; k++) bin[k] = k, count[k] /= n > 0 ? n : 1;
    for (int k = 0; k < CLASSIFIER_BINS; k++) mates[k] /= n > 0 ? n : 1;
    json *j = json_open(g->self->json);
    json_string(j, "shape", shapes[g->shape]);
    json_bool(j, "drag", g->drag == 0);
    json_bool(j, "one_rate", g->one_rate);
    json_array(j, "contacts_histogram", count, BINS);
    json_array(j, "impact_radius_m", hits, hits ? of_hits : 0);
    json_object_begin(j, "residence_time_s");
    json_number(j, "mean", stay.mean), json_number(j, "sd", deviation(&stay));
    json_object_end(j);
    results_values(
        j, {"rpm", g->rpm}, {"cor", g->restitution}, {"particles", n}, {"unfinished", unfinished},
        {"loading_kg_kg", g->loading}, {"depth_m", g->depth}, {"entered", (double)r->n}, {"time_s", w->time},
        {"contacts_mean", contacts.mean}, {"contacts_sd", deviation(&contacts)},
        {"contacts_standard_error", deviation(&contacts) / sqrt(contacts.n)}, {"paddle_contacts_mean", paddles.mean},
        {"particle_contacts_mean", others.mean}, {"particle_contacts_sd", deviation(&others)},
        {"particle_contacts_standard_error", deviation(&others) / sqrt(others.n)},
        {"particle_contacts_first_half", half[0].n > 0.0 ? half[0].mean : (double)NAN},
        {"particle_contacts_second_half", half[1].n > 0.0 ? half[1].mean : (double)NAN}, {"longest_stay_s", longest},
        {"impact_radius_mean_m", radius.mean}, {"impact_radius_sd_m", deviation(&radius)},
        {"impact_speed_mean_m_s", speed.mean},
        {"impact_speed_over_rim", speed.mean / (omega(g) * g->machine.wheel.outer_radius)}, {"cor_mean", cor},
        {"cor_sd", cor_sd}, {"rebound_angle_sd_deg", turned_sd}, {"rebounds", (double)r->rebounds},
        {"contact_time_s", g->contact_time}, {"outward_share", n > 0 ? outward / n : (double)NAN},
        {"present", (double)w->count}, {"steps", (double)w->step}, {"particle_steps", (double)w->particle_steps},
        {"contact_steps", (double)w->contact_steps}, {"core_overlaps", (double)r->overlaps},
        {"core_overlap_steps", (double)dem_core_overlap_steps(w)}, {"processor_s", machine_processor_seconds()});
    if (r->overlaps > 0)
        common_print("bricks overlap deeper than their rounding, in one another or in a paddle (%d at a time): shorten "
                     "--contact-ns\n",
                     (int)r->overlaps);
    common_print("%d histories in %.3f ms, %d particles present at the end, %d histories not over\n", n, 1e3 * w->time,
                 (int)w->count, unfinished);
    common_print("contacts of a particle %.3f +- %.3f (standard error; sd %.2f): paddles %.3f, particles %.3f\n",
                 contacts.mean, deviation(&contacts) / sqrt(contacts.n), deviation(&contacts), paddles.mean,
                 contacts.mean - paddles.mean);
    common_print("first hit at %.3f mm (sd %.3f), speed %.3f of the rim's; stay %.3f ms (sd %.3f, longest %.2f); "
                 "outward %.3f\n",
                 1e3 * radius.mean, 1e3 * deviation(&radius), speed.mean / (omega(g) * g->machine.wheel.outer_radius),
                 1e3 * stay.mean, 1e3 * deviation(&stay), 1e3 * longest, n > 0 ? outward / n : (double)NAN);
    common_print("restitution at a paddle %.3f (sd %.3f), angle off the mirrored one %.1f degrees (sd), %d rebounds\n",
                 cor, cor_sd, turned_sd, (int)r->rebounds);
    if (n > 0) separate(g, j, mates, CLASSIFIER_BINS, isnan(cor) ? g->restitution : cor, isnan(cor_sd) ? 0.01 : cor_sd);
    double edge[25], share[24] = {0};
    const classifier_wheel *wheel = &g->machine.wheel;
    for (int k = 0; k < 25; k++)
        edge[k] = 1e3 * (wheel->inner_radius + (wheel->outer_radius - wheel->inner_radius) * (k + 0.5) / 24.0);
    for (int k = 0; k < of_hits && hits; k++) {
        const double at = (hits[k] - wheel->inner_radius) / (wheel->outer_radius - wheel->inner_radius) * 24.0;
        share[at >= 24.0 ? 23 : at > 0.0 ? (int)at : 0] += 1.0 / of_hits;
    }
    riddle_plot *figure = riddle_plot_new("One interspace of a deflector wheel", 1, 2);
    riddle_plot_panel(figure, 0, 0, "contacts of a particle", "share of particles [-]");
    riddle_plot_points(figure, "paddles and particles", bin, count, BINS);
    riddle_plot_panel(figure, 0, 1, "radius of the first hit [mm]", "share of hits [-]");
    riddle_plot_line(figure, g->drag == 0 ? "with drag" : "without drag", edge, share, 24);
    riddle_plot_write(figure, g->self->out, "paddle_gap.svg");
    json_program(j, g->self);
    json_close(j);
    free(hits);
}

int main(int argc, char **argv) {
    gap g;
    memset(&g, 0, sizeof g);
    bool brief = false;
    double depth = 1.0, smallest = 30.0, longest = 5.0, median = 50.0, contact = 100.0, warm = 0.3;
    g.particles = 10000, g.rpm = 9000.0, g.loading = 40.0, g.spread = 0.7;
    g.shape = SPHERE, g.least = 0.05, g.restitution = 0.29;
    option options[] = {
        option_choice("shape", &g.shape, "brick|sphere|clump|both",
                      "bricks 1 : 1 : 2.08, spheres, pairs of spheres, or half bricks"),
        option_positive("cor", "X", &g.restitution, 1.0,
                        "coefficient of restitution of contacts [-]; particles of 0.7 and more are glass beads"),
        option_choice("drag", &g.drag, "on|off", "drag of the gas that turns with the wheel (Schiller & Naumann)"),
        option_double("rpm", "RPM", &g.rpm, 100.0, 30000.0, "speed of the wheel [1/min]"),
        option_double("depth-mm", "MM", &depth, 0.1, 20.0, "depth of the slice along the axis, periodic [mm]"),
        option_double("x-min-um", "UM", &smallest, 5.0, 150.0, "smallest particle simulated [um]"),
        option_positive("time-ms", "MS", &longest, 1e3, "longest time simulated [ms]"),
        option_int("particles", "N", &g.particles, 10, 1000000, "histories that are followed to their end"),
        option_double("warm-ms", "MS", &warm, 0.0, 1e3, "time in which the gap fills before histories count [ms]"),
        option_double("loading", "X", &g.loading, 1e-3, 100.0,
                      "mass of solids in a volume at the rim over that of the gas [kg/kg]"),
        option_positive("median-um", "UM", &median, 1e3,
                        "stand-in for the sizes: median by mass of a lognormal law up to 180 um [um]"),
        option_double("spread", "X", &g.spread, 0.05, 3.0, "its standard deviation of ln x [-]"),
        option_string("sizes", "FILE", &g.sizes_file,
                      "sizes instead: CSV with size_um (or _m, _mm) and share, of mass"),
        option_string("field", "FILE", &g.field_file,
                      "gas instead of the stand-in: CSV with x_m, y_m, u_m_s, v_m_s seen from the wheel"),
        option_double("contact-ns", "NS", &contact, 5.0, 1000.0,
                      "duration of a contact, the same for all sizes; 30 with bricks, whose rounding is thin [ns]"),
        option_double("least", "X", &g.least, 0.0, 1.0,
                      "approach over the speed of the rim from which a contact counts [-]"),
        option_flag("one-rate", &g.one_rate, "every particle takes the steps of contacts: for comparison"),
        option_flag("short", &brief,
                    "1000 histories in 0.5 mm at a loading of 10, with bricks 200 at 3, under a minute"),
    };
    program self =
        program_start("paddle_gap", "Particles between two paddles of a deflector wheel: contacts, hits, residence.",
                      options, sizeof options / sizeof *options, argc, argv);
    const double ends_of[6] = {0.0, 0.0, -0.5, 0.0, 0.0, 0.5}, two[2] = {1.0, 1.0};
    dem_make_clump(2, ends_of, two, &g.clump);
    if ((self.quick || brief) && !is_given(&self, "depth-mm")) depth = g.shape == SPHERE ? 0.5 : 0.65;
    const bool bricks = g.shape == BRICK || g.shape == BOTH;
    if (bricks && !is_given(&self, "contact-ns")) contact = 30.0;
    if (self.quick && !is_given(&self, "x-min-um")) smallest = bricks ? 90.0 : 60.0;
    if (brief && !is_given(&self, "loading")) g.loading = bricks ? 3.0 : 10.0;
    if ((self.quick || brief) && !is_given(&self, "warm-ms")) warm = self.quick ? 0.0 : 0.2;
    if ((self.quick || brief) && !is_given(&self, "particles")) g.particles = self.quick ? 30 : bricks ? 200 : 1000;
    g.self = &self;
    g.depth = 1e-3 * depth, g.smallest = 1e-6 * smallest, g.longest = 1e-3 * longest, g.median = 1e-6 * median;
    g.warm = 1e-3 * warm, g.contact_time = 1e-9 * contact;
    g.machine = classifier_paper_def(g.restitution >= 0.7 ? CLASSIFIER_BEADS : CLASSIFIER_LIMESTONE, g.rpm, NULL);
    choose_sizes(&g);
    const double wide = 4.5 * reach(&g, g.shape == BOTH ? BRICK : g.shape, largest(&g));
    if (!(g.depth > wide)) {
        char text[40], allowed[80];
        snprintf(text, sizeof text, "%g", depth);
        snprintf(allowed, sizeof allowed, "over %.3g, 2.25 of the largest particles' length", 1e3 * wide);
        program_refuse(&self, "depth-mm", text, allowed);
    }
    dem_world w;
    record r;
    memset(&r, 0, sizeof r);
    r.g = &g;
    dem_gas gas = dem_default_gas();
    double *velocity = g.drag ? NULL : g.field_file ? field_of_file(&g, &gas) : analytic_field(&g, &gas);
    gas.velocity = velocity;
    gas.density = g.machine.fluid_density, gas.viscosity = g.machine.viscosity;
    memset(&w, 0, sizeof w);
    dem_status status = build(&w, &g);
    w.user = &r;
    if (status == DEM_OK && velocity) {
        status = dem_attach_gas(&gas, &w, 0);
        const dem_force_field field = dem_gas_field(air_drag, &gas);
        if (status == DEM_OK) status = dem_set_force_field(&w, &field);
    }
    if (status == DEM_OK) status = run(&w, &r);
    if (status != DEM_OK) common_fail("%s at %g ms", dem_status_text(status), 1e3 * w.time);
    else if (common_exit_status() == 0) report(&g, &w, &r);
    dem_free(&w);
    free(r.of), free(velocity);
    return common_exit_status();
}
