/* Spheres that settle in a closed box, the flow resolved around them, by filtration.h.

   settling --case A1        the cases of Puderbach, Schmidt & Antonyuk, Processes 9 (2021) 826 ("the paper"), Table 2:
                             A1 to A5 and B1 (periodic sides), C1 to C3 (walls), D1 (onto a wire cloth); glass of 80 um
                             in water
   settling --case E1        ten Cate, Nieuwstad, Derksen & Van den Akker, Phys Fluids 14 (2002) 4012: 15 mm in oil, E1
                             to E4
   settling --beside DIR,DIR draws earlier runs (their --out folders) into the figures; with --draw it runs nothing, and
   draws the first of
                             them, which is --case, with the others

   Your own case             a row of scenes[] below, and its name in CASE_NAMES

   A sphere on the axis of its box is computed in a quarter of the box between two mirrors (--symmetry full: the whole
   box). track.csv: the path of each sphere. velocity.svg, reynolds.svg (beside the balance of forces with the drag law
   of each author), bottom.svg (v / v_t over the gap x / d, beside Brenner), height.svg: the paper's Figs 11, 13 and
   15a, 15b, 17. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "filtration.h"

enum { MOST_SPHERES = 3, SAMPLES = 1500, LONGEST_TRACK = SAMPLES + 700, MOST_BESIDE = 10, LAWS = 5 };
/* ---- cases ---- */

typedef enum sides { SIDES_PERIODIC, SIDES_WALL } sides;

typedef struct scene {
    const char *name;
    sides around;
    int spheres, cloth;
    double width, height, diameter, density, fluid_density, viscosity;
    double start;          /* lowest centre over the bottom [m] */
    double spacing;        /* of the centres [m] */
    double time;           /* [s], enough to reach the bottom */
    double wall_factor;    /* drag at rest over Stokes' at the middle height; exact (spec section 4), 0: unknown */
    double velocity;       /* measured or computed by others [m/s]; 0: none */
    const char *reference; /* whose wall_factor or velocity */
} scene;

#define PAPER(name, around, spheres, cloth, width, height, spacing, time, factor, reference)                           \
    {                                                                                                                  \
        name, around, spheres, cloth, width, height, 80e-6, 2200.0, 1000.0, 1e-3, 722e-6, spacing, time, factor, 0.0,  \
            reference                                                                                                  \
    }
#define TEN_CATE(name, density, viscosity, time, velocity)                                                             \
    {                                                                                                                  \
        name, SIDES_WALL, 1, 0, 0.1, 0.16, 0.015, 1120.0, density, viscosity, 0.1275, 0.0, time, 0.0, velocity,        \
            "measured, ten Cate et al."                                                                                \
    }

static const scene scenes[] = {
    PAPER("A1", SIDES_PERIODIC, 1, 0, 320e-6, 802e-6, 0.0, 0.29, 1.5549, "row of spheres, no net flux"),
    PAPER("A2", SIDES_PERIODIC, 1, 0, 160e-6, 802e-6, 0.0, 0.55, 2.9663, "row of spheres, no net flux"),
    PAPER("A3", SIDES_PERIODIC, 1, 0, 640e-6, 802e-6, 0.0, 0.23, 1.222, "row of spheres, no net flux"),
    PAPER("A4", SIDES_PERIODIC, 2, 0, 320e-6, 1128e-6, 320e-6, 0.36, 0.0, NULL),
    PAPER("A5", SIDES_PERIODIC, 3, 0, 320e-6, 1128e-6, 160e-6, 0.36, 0.0, NULL),
    PAPER("B1", SIDES_PERIODIC, 1, 0, 320e-6, 804e-6, 0.0, 0.29, 1.5549, "row of spheres, no net flux"),
    PAPER("C1", SIDES_WALL, 1, 0, 320e-6, 802e-6, 0.0, 0.33, 1.823, "square duct with closed ends"),
    PAPER("C2", SIDES_WALL, 1, 0, 160e-6, 802e-6, 0.0, 0.82, 4.54, "square duct with closed ends"),
    PAPER("C3", SIDES_WALL, 1, 0, 640e-6, 802e-6, 0.0, 0.24, 1.306, "square duct with closed ends"),
    PAPER("D1", SIDES_PERIODIC, 1, 1, 320e-6, 802e-6, 0.0, 0.27, 1.5549, "row of spheres, no net flux"),
    TEN_CATE("E1", 970.0, 0.373, 4.0, 0.038 * 0.947),
    TEN_CATE("E2", 965.0, 0.212, 2.6, 0.060 * 0.953),
    TEN_CATE("E3", 962.0, 0.113, 1.9, 0.091 * 0.959),
    TEN_CATE("E4", 960.0, 0.058, 1.5, 0.128 * 0.955),
};
#define CASE_NAMES "A1|A2|A3|A4|A5|B1|C1|C2|C3|D1|E1|E2|E3|E4"

static double volume(const scene *s) { return RIDDLE_PI / 6.0 * s->diameter * s->diameter * s->diameter; }
static double stokes(const scene *s) {
    return filtration_stokes_velocity(s->density - s->fluid_density, 9.81, s->diameter, s->viscosity);
}
static double reynolds(const scene *s, double v) { return fabs(v) * s->diameter * s->fluid_density / s->viscosity; }

/* ---- drag laws ---- */

static const char *const law_names[LAWS] = {"Stokes", "Schiller-Naumann", "Ladenburg", "Faxen", "Haberman-Sayre"};
static const char *const law_keys[LAWS] = {"stokes", "schiller_naumann", "ladenburg", "faxen", "haberman_sayre"};

/* Drag over Stokes' by law k; walls as if the box were a round tube of its width. NaN: outside the law's range. */
static double drag_factor(const scene *s, int k, double v) {
    const double ratio = s->diameter / s->width;
    if (k == 1) return filtration_schiller_naumann(reynolds(s, v));
    if (k == 2) return filtration_wall_ladenburg(ratio);
    if (k == 3) return filtration_wall_faxen(ratio);
    return k == 4 ? filtration_wall_haberman_sayre(ratio) : 1.0;
}

static double terminal(const scene *s, int k) {
    double v = stokes(s);
    for (int i = 0; i < 200; i++)
        v = 0.5 * (v + stokes(s) / drag_factor(s, k, v)); /* half steps: a fixed point of a falling function */
    return v;
}

/* Velocity in time by the balance of weight, drag and half the displaced mass (added mass); Runge-Kutta of
   fourth order. */
static void balance(const scene *s, int k, const double *time, int n, double *re) {
    const double mass = (s->density + 0.5 * s->fluid_density) * volume(s),
                 weight = (s->density - s->fluid_density) * volume(s) * 9.81;
    const double stiff = 3.0 * RIDDLE_PI * s->viscosity * s->diameter;
    double v = 0.0;
    re[0] = 0.0;
    for (int i = 1; i < n; i++) {
        const double span = time[i] - time[i - 1];
        const int steps = (int)(span / (0.2 * mass / stiff / drag_factor(s, k, v))) + 1;
        const double h = span / steps;
        for (int j = 0; j < steps; j++) {
#define PULL(u) ((weight - stiff * drag_factor(s, k, (u)) * (u)) / mass)
            const double a = PULL(v), b = PULL(v + 0.5 * h * a), c = PULL(v + 0.5 * h * b), d = PULL(v + h * c);
#undef PULL
            v += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        }
        re[i] = reynolds(s, v);
    }
}

/* ---- tracks ---- */

typedef struct track {
    int n, spheres;
    double time[LONGEST_TRACK];                   /* [s] */
    double height[MOST_SPHERES][LONGEST_TRACK];   /* of the centre over the bottom [m] */
    double velocity[MOST_SPHERES][LONGEST_TRACK]; /* downwards [m/s] */
    double terminal;                              /* of the lowest sphere: terminal_velocity [m/s] */
    bool accelerates;                             /* or has not come far enough to tell */
} track;

static void take_sample(track *t, double time, const double *centre, const double *velocity) {
    if (t->n >= LONGEST_TRACK) return;
    t->time[t->n] = time;
    for (int i = 0; i < t->spheres; i++)
        t->height[i][t->n] = centre[3 * i + 2], t->velocity[i][t->n] = -velocity[3 * i + 2];
    t->n++;
}

/* Returns the sample at which the lowest sphere was half a diameter higher, or -1. */
static int half_a_diameter_before(const track *t, int k, double diameter) {
    int before = k - 1;
    while (before >= 0 && t->height[0][before] - t->height[0][k] < 0.5 * diameter) before--;
    return before;
}

/* Largest mean velocity of the lowest sphere over half a diameter travelled, after the first half: the lattice's grain
   and the sound of the start are averaged out. The largest of all if it has not come that far. A sphere whose mean is a
   hundredth larger over the last half of a diameter than over the one before still accelerates. */
static double terminal_velocity(track *t, double diameter) {
    double best = 0.0;
    for (int i = 0, j = 0; i < t->n; i++) {
        if (t->height[0][0] - t->height[0][i] < 0.5 * diameter) continue;
        while (j < t->n && t->height[0][i] - t->height[0][j] < 0.5 * diameter) j++;
        if (j == t->n) break;
        best = fmax(best, (t->height[0][i] - t->height[0][j]) / (t->time[j] - t->time[i]));
    }
    const int now = t->n - 1, before = half_a_diameter_before(t, now, diameter),
              first = half_a_diameter_before(t, before, diameter);
    t->accelerates =
        first < 0 || !((t->height[0][before] - t->height[0][now]) * (t->time[before] - t->time[first]) <
                       1.01 * (t->height[0][first] - t->height[0][before]) * (t->time[now] - t->time[before]));
    for (int i = 0; i < t->n && best == 0.0; i++) best = t->velocity[0][t->n - 1 - i];
    return best;
}

static void write_track(const program *self, const scene *s, const track *t) {
    char header[400] = "time_s";
    for (int i = 0; i < t->spheres; i++)
        snprintf(header + strlen(header), sizeof header - strlen(header),
                 ",height_%d_m,velocity_%d_m_per_s,re_%d,x_over_d_%d", i + 1, i + 1, i + 1, i + 1);
    riddle_io_file *file = csv_open(self->out, "track.csv", header);
    for (int k = 0; k < t->n; k++) {
        double cells[1 + 4 * MOST_SPHERES] = {t->time[k]};
        for (int i = 0; i < t->spheres; i++) {
            double *c = cells + 1 + 4 * i;
            c[0] = t->height[i][k], c[1] = t->velocity[i][k], c[2] = reynolds(s, c[1]), c[3] = c[0] / s->diameter - 0.5;
        }
        riddle_io_row(file, cells, 1 + 4 * t->spheres);
    }
    riddle_io_close(file);
}

/* An earlier run's track. Its case is the last part of its folder's name. */
typedef struct beside {
    char name[64];
    track *t;
} beside;

static int read_beside(const program *self, const char *folders, beside *runs) {
    int n = 0;
    for (const char *at = folders; at && *at && n < MOST_BESIDE;) {
        char path[500], message[400];
        const size_t length = strcspn(at, ",");
        snprintf(path, sizeof path, "%.*s/track.csv", (int)length, at);
        const char *end = at + length, *name = end;
        while (name > at && name[-1] != '/') name--;
        snprintf(runs[n].name, sizeof runs[n].name, "%.*s", (int)(end - name), name);
        csv_data data;
        if (csv_read(path, &data, message, sizeof message) != 0) program_refuse(self, "beside", path, message);
        track *t = runs[n].t = calloc(1, sizeof *t);
        if (!t) exit((common_fail("out of memory"), common_exit_status()));
        t->spheres = (data.columns - 1) / 4 < MOST_SPHERES ? (data.columns - 1) / 4 : MOST_SPHERES;
        for (t->n = 0; t->n < data.rows && t->n < LONGEST_TRACK; t->n++) {
            const double *row = data.values + (ptrdiff_t)t->n * data.columns;
            t->time[t->n] = row[0];
            for (int i = 0; i < t->spheres; i++)
                t->height[i][t->n] = row[1 + 4 * i], t->velocity[i][t->n] = row[2 + 4 * i];
        }
        csv_free(&data);
        n++;
        at = *end ? end + 1 : end;
    }
    return n;
}

/* ---- the run ---- */

/* What the command line chooses. */
typedef struct choices {
    double voxel, tau, time; /* 0: by the case */
    double field;            /* time at which the flow is drawn [s]; 0: never */
    double sound_share; /* of the time that has passed, in which sound crosses the box; 0: tau holds from the start */
    int quarter, paper_force, half_way, float_storage, until_bottom, quiet_spheres;
} choices;

/* A cloth whose period does not fit the box is cut at the box's faces, as in the paper, and repeats itself
   with the box. */
typedef struct seamed_cloth {
    filtration_cloth cloth;
    double width;
} seamed_cloth;

static double seamed_distance(const void *self, const double point[3]) {
    const seamed_cloth *c = self;
    double inside[3] = {point[0], point[1], point[2]};
    for (int k = 0; k < 2; k++) inside[k] -= c->width * floor(inside[k] / c->width);
    return filtration_cloth_distance(&c->cloth, inside);
}

/* Of a sphere that does not touch the cut. */
static int seamed_touch(const void *self, const double centre[3], double radius, double reach, int most,
                        filtration_near *near) {
    const seamed_cloth *c = self;
    const filtration_solid solid = filtration_cloth_solid(&c->cloth);
    double inside[3] = {centre[0], centre[1], centre[2]};
    for (int k = 0; k < 2; k++) inside[k] -= c->width * floor(inside[k] / c->width);
    return solid.touch(&c->cloth, inside, radius, reach, most, near);
}

typedef struct run {
    const scene *s;
    choices choice;
    filtration_fluid fluid;
    filtration_motion_def motion;
    seamed_cloth cloth;
    double centre[3 * MOST_SPHERES], velocity[3 * MOST_SPHERES], spin[3 * MOST_SPHERES], radius[MOST_SPHERES];
    double force[3 * MOST_SPHERES], torque[3 * MOST_SPHERES];
    filtration_spheres spheres;
    double share;
    double seconds;
} run;

/* Time in which a sphere at rest comes to 63 % of its velocity, by the drag beside walls at rest [s]. */
static double response(const scene *s) {
    return (s->density + 0.5 * s->fluid_density) * s->diameter * s->diameter /
           (18.0 * s->viscosity * fmax(s->wall_factor, 1.0));
}

/* Relaxation time for a lattice speed of 0.02, kept where the scheme is accurate: once the start is over. */
static double fitting_tau(const scene *s, double voxel) {
    const double cell_reynolds = terminal(s, 1) * voxel * s->fluid_density / s->viscosity;
    return fmin(fmax(0.5 + 0.06 / cell_reynolds, 0.6), 3.5);
}

/* Relaxation time with which sound crosses the height of the box in `share` of the time that has passed since the
   start, or that the sphere needs to respond. In a closed box there is no return flow before sound has crossed it. */
static double sound_tau(const run *r) {
    const scene *s = r->s;
    const double shown = fmax(r->fluid.time, 0.5 * response(s));
    const double crossing =
        s->height * r->choice.voxel * s->fluid_density / (s->viscosity * sqrt(3.0)); /* times tau - 1/2 [s] */
    return 0.5 + r->choice.sound_share * shown / crossing;
}

static filtration_fluid_def fluid_def(run *r, int threads) {
    const scene *s = r->s;
    const choices *c = &r->choice;
    filtration_fluid_def def = filtration_fluid_default_def();
    def.voxel = c->voxel, def.tau = c->sound_share > 0.0 ? fmin(c->tau, sound_tau(r)) : c->tau, def.threads = threads;
    def.density = s->fluid_density, def.viscosity = s->viscosity;
    const int across = (int)floor(s->width / c->voxel + 0.5);
    def.nodes[0] = def.nodes[1] = c->quarter ? across / 2 : across;
    def.nodes[2] = (int)floor(s->height / c->voxel + 0.5);
    for (int f = 0; f < 4; f++) def.face[f] = s->around == SIDES_WALL ? FILTRATION_WALL : FILTRATION_PERIODIC;
    if (c->quarter) {
        def.face[FILTRATION_LOW_X] = def.face[FILTRATION_LOW_Y] = FILTRATION_SYMMETRY;
        if (s->around == SIDES_PERIODIC)
            def.face[FILTRATION_HIGH_X] = def.face[FILTRATION_HIGH_Y] = FILTRATION_SYMMETRY;
    }
    def.face[FILTRATION_LOW_Z] = def.face[FILTRATION_HIGH_Z] = FILTRATION_WALL;
    if (c->paper_force) def.force = FILTRATION_SHEAR_LAYER;
    if (c->half_way) def.boundary = FILTRATION_HALF_WAY;
    if (c->float_storage) def.precision = FILTRATION_FLOAT;
    if (s->cloth) {
        filtration_cloth_make(&r->cloth.cloth, 28e-6, 32e-6, FILTRATION_TWILL_WEAVE, 28e-6);
        r->cloth.width = def.nodes[0] * c->voxel;
        def.solid.distance = seamed_distance, def.solid.touch = seamed_touch, def.solid.self = &r->cloth;
    }
    return def;
}

static filtration_status set_up(run *r, const program *self) {
    const scene *s = r->s;
    const filtration_fluid_def def = fluid_def(r, self->threads);
    const double middle = r->choice.quarter ? 0.0 : 0.5 * def.nodes[0] * def.voxel;
    r->motion = filtration_motion_default_def();
    r->motion.density = s->density;
    if (r->choice.quarter) r->motion.fixed_axes[0] = r->motion.fixed_axes[1] = 1, r->motion.spin = 0;
    r->share = r->choice.quarter ? 4.0 : 1.0;
    for (int i = 0; i < s->spheres; i++) {
        /* a row on the axis would stay on it: the upper ones stand a thousandth of their diameter aside */
        r->centre[3 * i] = middle + (i > 0 ? 1e-3 * i * s->diameter : 0.0), r->centre[3 * i + 1] = middle;
        r->centre[3 * i + 2] = s->start + i * s->spacing;
        r->radius[i] = 0.5 * s->diameter;
    }
    const filtration_spheres all = {s->spheres, r->centre, r->velocity, r->spin, r->radius, r->force, r->torque};
    r->spheres = all;
    const char *field = "";
    if (filtration_fluid_check_def(&def, &field) != FILTRATION_OK && strcmp(field, "nodes") == 0)
        program_refuse(self, "voxel-um", NULL, "larger ones: these are more than a lattice can count");
    program_need_memory(self, "voxel-um", filtration_fluid_bytes(&def));
    return filtration_fluid_init(&r->fluid, &def);
}

/* Every sphere rests on the bottom, on the cloth or on another. */
static int has_arrived(const run *r, const track *t, double fastest) {
    const double rest = r->s->cloth ? 2.0 * r->cloth.cloth.wire : 0.0;
    for (int i = 0; i < r->s->spheres; i++)
        if (fabs(r->velocity[3 * i + 2]) > 0.01 * fastest) return 0;
    return t->n > 20 && r->centre[2] < 0.55 * r->s->diameter + rest;
}

/* The lowest sphere moves no faster than it has for half a diameter. */
static int is_terminal(const run *r, const track *t) {
    if (t->n < 20 || t->height[0][0] - r->centre[2] < 2.0 * r->s->diameter) return 0;
    int k = t->n - 1;
    while (k > 0 && t->height[0][k] < r->centre[2] + 0.5 * r->s->diameter) k--;
    return k > 0 && t->velocity[0][k] > 0.999 * -r->velocity[2];
}

/* Longer time steps as the start fades away. */
static filtration_status lengthen_step(run *r) {
    const double now = r->fluid.def.tau - 0.5, next = fmin(sound_tau(r), r->choice.tau);
    return r->choice.sound_share > 0.0 && next - 0.5 > 1.1 * now ? filtration_fluid_set_tau(&r->fluid, next)
                                                                 : FILTRATION_OK;
}

/* Time between two samples: short at the start, where the figures' first milliseconds are. */
static double sample_every(const run *r) {
    return fmin(r->choice.time / SAMPLES, fmax(0.02 * r->fluid.time, 0.05 * response(r->s)));
}

/* Speed of the liquid in the plane through the axis, as the paper's Figs 12, 14 and 16 show it. */
static void draw_flow(const program *self, const run *r) {
    const int *n = r->fluid.def.nodes, y = r->choice.quarter ? 0 : n[1] / 2;
    const double width = 1e3 * n[0] * r->choice.voxel, height = 1e3 * n[2] * r->choice.voxel;
    char title[80];
    double *values = malloc(sizeof(double) * (size_t)n[0] * (size_t)n[2]);
    if (!values) {
        common_fail("out of memory for flow.svg");
        return;
    }
    for (int z = 0; z < n[2]; z++)
        for (int x = 0; x < n[0]; x++) {
            filtration_sample at;
            const bool fluid = filtration_fluid_at(&r->fluid, x, y, z, &at) == FILTRATION_OK && at.owner == -1;
            const double *v = at.velocity;
            values[z * n[0] + x] = fluid ? 1e3 * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) : (double)NAN;
        }
    snprintf(title, sizeof title, "Speed of the liquid after %.3g ms", 1e3 * r->fluid.time);
    riddle_plot *figure = riddle_plot_new(title, 1, 1);
    riddle_plot_panel(figure, 0, 0, r->choice.quarter ? "from the axis [mm]" : "x [mm]", "height [mm]");
    riddle_plot_panel_size(figure, 180.0, 180.0 * fmin(height / width, 5.0));
    riddle_plot_heat(figure, "speed [mm/s]", values, n[0], n[2], 0.0, width, 0.0, height);
    riddle_plot_write(figure, self->out, "flow.svg");
    free(values);
}

static filtration_status go(const program *self, run *r, track *t, progress *bar) {
    const double began = machine_seconds();
    double next = sample_every(r), fastest = 0.0, field = r->choice.field > 0.0 ? r->choice.field : HUGE_VAL;
    filtration_status status = FILTRATION_OK;
    t->spheres = r->s->spheres;
    take_sample(t, 0.0, r->centre, r->velocity);
    while (status == FILTRATION_OK && r->fluid.time < r->choice.time && !common_interrupted()) {
        status = filtration_fluid_step(&r->fluid, &r->spheres);
        if (status == FILTRATION_OK) status = filtration_move(&r->motion, &r->fluid, &r->spheres, r->share, NULL);
        if (status == FILTRATION_OK) status = lengthen_step(r);
        if (status == FILTRATION_OK && r->fluid.time >= field) draw_flow(self, r), field = HUGE_VAL;
        if (r->fluid.time < next) continue;
        next = r->fluid.time + sample_every(r);
        fastest = fmax(fastest, -r->velocity[2]);
        take_sample(t, r->fluid.time, r->centre, r->velocity);
        progress_update(bar, r->fluid.time);
        if (r->choice.until_bottom ? has_arrived(r, t, fastest) : is_terminal(r, t)) break;
    }
    r->seconds = machine_seconds() - began;
    return status;
}

/* ---- reports ---- */

static void report_references(json *report, const scene *s) {
    json_object_begin(report, "v_reference_m_per_s");
    for (int k = 0; k < LAWS; k++) json_number(report, law_keys[k], terminal(s, k));
    if (s->wall_factor > 0.0) json_number(report, "exact_at_rest", stokes(s) / s->wall_factor);
    if (s->velocity > 0.0) json_number(report, "measured", s->velocity);
    json_object_end(report);
}

static void report_run(json *report, const run *r, const track *t) {
    const scene *s = r->s;
    const filtration_fluid_def *def = &r->fluid.def;
    const double nodes = (double)def->nodes[0] * def->nodes[1] * def->nodes[2];
    double fastest = 0.0, values[LONGEST_TRACK];
    for (int k = 0; k < t->n; k++) fastest = fmax(fastest, t->velocity[0][k]);
    json_string(report, "case", s->name);
    results_values(report, {"voxel_m", def->voxel}, {"tau", def->tau},
                   {"cells_per_diameter", s->diameter / def->voxel});
    json_bool(report, "quarter", r->choice.quarter != 0);
    results_values(report, {"re_max", reynolds(s, fastest)}, {"v_max_m_per_s", fastest},
                   {"v_terminal_m_per_s", t->accelerates ? (double)NAN : t->terminal});
    json_bool(report, "still_accelerates", t->accelerates);
    report_references(report, s);
    json_array(report, "time_s", t->time, t->n);
    static const char *const keys[] = {"height_m", "re", "x_over_d", "v_over_vt"};
    for (int q = 0; q < 4; q++) {
        json_array_begin(report, keys[q]);
        for (int i = 0; i < t->spheres; i++) {
            for (int k = 0; k < t->n; k++) {
                const double h = t->height[i][k], v = t->velocity[i][k];
                values[k] = q == 0 ? h : q == 1 ? reynolds(s, v) : q == 2 ? h / s->diameter - 0.5 : v / t->terminal;
            }
            json_array(report, NULL, values, t->n);
        }
        json_array_end(report);
    }
    results_values(report, {"nodes", nodes}, {"steps", (double)r->fluid.steps}, {"run_s", r->seconds},
                   {"mlups", r->seconds > 0.0 ? 1e-6 * (double)r->fluid.updates / r->seconds : 0.0});
}

static void print_run(const run *r, const track *t) {
    const scene *s = r->s;
    common_print("%s: %.3g cells a diameter, tau %.3g, %d x %d x %d nodes%s, %lld steps, %.1f s, %.0f MLUPS\n\n",
                 s->name, s->diameter / r->fluid.def.voxel, r->fluid.def.tau, r->fluid.def.nodes[0],
                 r->fluid.def.nodes[1], r->fluid.def.nodes[2], r->choice.quarter ? " (a quarter)" : "",
                 (long long)r->fluid.steps, r->seconds,
                 r->seconds > 0.0 ? 1e-6 * (double)r->fluid.updates / r->seconds : 0.0);
    riddle_io_table rows = riddle_io_table_begin("terminal velocity|[mm/s]|Re [-]|simulated over it");
    riddle_io_table_cell(&rows, "%s", t->accelerates ? "none yet; so far" : "simulated"),
        riddle_io_table_cell(&rows, "%.4g", 1e3 * t->terminal),
        riddle_io_table_cell(&rows, "%.3g", reynolds(s, t->terminal));
    riddle_io_table_cell(&rows, "%s", "");
    for (int k = 0; k < LAWS + 2; k++) {
        const double v = k < LAWS    ? terminal(s, k)
                         : k == LAWS ? (s->wall_factor > 0.0 ? stokes(s) / s->wall_factor : (double)NAN)
                                     : s->velocity;
        if (!(v > 0.0)) continue;
        riddle_io_table_cell(&rows, "%s", k < LAWS ? law_names[k] : s->reference),
            riddle_io_table_cell(&rows, "%.4g", 1e3 * v);
        riddle_io_table_cell(&rows, "%.3g", reynolds(s, v));
        if (t->accelerates) riddle_io_table_cell(&rows, "%s", "");
        else riddle_io_table_cell(&rows, "%.4f", t->terminal / v);
    }
    table_end(&rows);
    if (t->accelerates)
        common_print(
            "The sphere still accelerates: there is no terminal velocity yet. A longer --time-ms gives one.\n");
}

/* ---- figures ---- */

typedef enum quantity { TIME, HEIGHT, VELOCITY, REYNOLDS, GAP, RELATIVE } quantity;

static void values_of(const scene *s, const track *t, int sphere, quantity q, double *out) {
    for (int k = 0; k < t->n; k++) {
        const double h = t->height[sphere][k], v = t->velocity[sphere][k];
        out[k] = q == TIME       ? 1e3 * t->time[k]
                 : q == HEIGHT   ? h / s->diameter - 0.5
                 : q == VELOCITY ? 1e3 * v
                                 : reynolds(s, v);
        if (q == GAP) out[k] = h / s->diameter - 0.5;
        if (q == RELATIVE) out[k] = v / t->terminal;
    }
}

static void add_track(riddle_plot *figure, const scene *s, const char *name, const track *t, quantity x, quantity y,
                      int flags) {
    double *values = malloc(2 * LONGEST_TRACK * sizeof *values);
    for (int i = 0; values && i < t->spheres; i++) {
        char label[80];
        if (t->spheres > 1) snprintf(label, sizeof label, "P%d (%s)", i + 1, name);
        else snprintf(label, sizeof label, "%s", name);
        values_of(s, t, i, x, values), values_of(s, t, i, y, values + LONGEST_TRACK);
        riddle_plot_line(figure, label, values, values + LONGEST_TRACK, t->n);
        riddle_plot_style(figure, flags, RIDDLE_PLOT_NEXT);
    }
    free(values);
}

static void add_all(riddle_plot *figure, const scene *s, const track *t, const beside *runs, int n, quantity x,
                    quantity y) {
    add_track(figure, s, s->name, t, x, y, 0);
    for (int i = 0; i < n; i++) add_track(figure, s, runs[i].name, runs[i].t, x, y, 0);
}

static void draw_reynolds(const program *self, const scene *s, const track *t, const beside *runs, int n) {
    double re[LONGEST_TRACK], ms[LONGEST_TRACK];
    riddle_plot *figure = riddle_plot_new("Reynolds number in time", 1, 1);
    riddle_plot_panel(figure, 0, 0, "time [ms]", "Re = v d ρ / µ [-]");
    add_all(figure, s, t, runs, n, TIME, REYNOLDS);
    values_of(s, t, 0, TIME, ms);
    for (int k = 0; k < LAWS; k++) {
        if (!(terminal(s, k) > 0.0)) continue;
        balance(s, k, t->time, t->n, re);
        riddle_plot_line(figure, law_names[k], ms, re, t->n);
        riddle_plot_style(figure, RIDDLE_PLOT_DASHED | RIDDLE_PLOT_THIN, RIDDLE_PLOT_NEXT);
    }
    riddle_plot_legend_outside(figure);
    riddle_plot_write(figure, self->out, "reynolds.svg");
}

/* Whether a sphere has come within a number of diameters of the bottom. */
static bool came_near(const scene *s, const track *t, double diameters) {
    double gap[LONGEST_TRACK];
    bool near = false;
    for (int i = 0; i < t->spheres; i++) {
        values_of(s, t, i, GAP, gap);
        for (int k = 0; k < t->n; k++) near = near || gap[k] < diameters;
    }
    return near;
}

static void draw_bottom(const program *self, const scene *s, const track *t, const beside *runs, int n) {
    enum { POINTS = 200 };
    double gap[POINTS], slowed[POINTS];
    bool near = came_near(s, t, 4.0);
    for (int i = 0; i < n; i++) near = near || came_near(s, runs[i].t, 4.0);
    if (!near) {
        figure_left_out(self->out, "bottom.svg", "no sphere has come within four diameters of the bottom");
        return;
    }
    riddle_plot *figure = riddle_plot_new("Approach to the bottom", 1, 1);
    riddle_plot_panel(figure, 0, 0, "gap to the bottom over the diameter, x / d [-]",
                      "velocity over its largest, v / v_t [-]");
    add_all(figure, s, t, runs, n, GAP, RELATIVE);
    for (int i = 0; i < POINTS; i++)
        gap[i] = 4.0 * (i + 1) / POINTS, slowed[i] = 1.0 / filtration_wall_brenner(2.0 * gap[i]);
    riddle_plot_line(figure, "Brenner, no side walls", gap, slowed, POINTS);
    riddle_plot_style(figure, RIDDLE_PLOT_DASHED, RIDDLE_PLOT_BLACK);
    riddle_plot_range_x(figure, 0.0, 4.0);
    riddle_plot_range_y(figure, 0.0, 1.05);
    riddle_plot_write(figure, self->out, "bottom.svg");
}

static void draw(const program *self, const scene *s, const track *t, const beside *runs, int n) {
    riddle_plot *figure = riddle_plot_new("Settling velocity", 1, 1);
    riddle_plot_panel(figure, 0, 0, "time [ms]", "velocity downwards [mm/s]");
    add_all(figure, s, t, runs, n, TIME, VELOCITY);
    riddle_plot_write(figure, self->out, "velocity.svg");
    figure = riddle_plot_new("Way to the bottom", 1, 1);
    riddle_plot_panel(figure, 0, 0, "time [ms]", "gap to the bottom over the diameter [-]");
    add_all(figure, s, t, runs, n, TIME, HEIGHT);
    riddle_plot_write(figure, self->out, "height.svg");
    draw_reynolds(self, s, t, runs, n);
    draw_bottom(self, s, t, runs, n);
}

/* ---- the command line ---- */

static choices completed(const program *self, const scene *s, choices c, double voxel_um, double time_ms,
                         int symmetry) {
    const int usual = s->name[0] == 'B'   ? 20
                      : s->name[0] == 'E' ? 20
                                          : 40; /* cells a diameter in the paper; 20 for ten Cate */
    c.voxel = voxel_um > 0.0 ? 1e-6 * voxel_um : s->diameter / usual;
    if (self->quick && !(voxel_um > 0.0)) c.voxel = s->diameter / 8.0;
    c.quarter = symmetry == 0 && s->spheres == 1 && !s->cloth;
    if (c.tau > 0.0) c.sound_share = 0.0;
    else c.tau = fitting_tau(s, c.voxel);
    c.time = time_ms > 0.0 ? 1e-3 * time_ms : self->quick ? 0.1 * s->time : s->time;
    return c;
}

int main(int argc, char **argv) {
    int which = 0, symmetry = 0, until = 0, boundary = 0, force = 0, precision = 0;
    double voxel = 0.0, time = 0.0, field = 0.0;
    const char *folders = NULL;
    bool drawn = false;
    choices chosen;
    memset(&chosen, 0, sizeof chosen);
    chosen.sound_share = 0.2;
    option options[] = {
        option_choice("case", &which, CASE_NAMES, "A, B, C, D: the paper; E: ten Cate et al."),
        option_positive("voxel-um", "L", &voxel, 1e5, "edge of a voxel [um]; default: the paper's, 2 or 4; 750 for E"),
        option_choice("symmetry", &symmetry, "quarter|full",
                      "one sphere on the axis: a quarter of the box between mirrors, or all of it"),
        option_choice("until", &until, "bottom|terminal",
                      "run until the spheres rest, or until the lowest no longer speeds up"),
        option_positive("time-ms", "T", &time, 1e7, "and at most so long [ms]; default: by the case"),
        option_positive("tau", "TAU", &chosen.tau, 10.0,
                        "relaxation time [-], above 0.5, from the start; default: by --sound-share, then for a lattice "
                        "speed of 0.02, 0.6 to 3.5"),
        option_positive("sound-share", "S", &chosen.sound_share, 1.0,
                        "sound crosses the box in this share of the time that has passed [-]; default 0.2"),
        option_positive("field-ms", "T", &field, 1e7, "draw the flow at this time [ms]: flow.svg"),
        option_choice("boundary", &boundary, "central-linear|half-way",
                      "surface of the spheres: interpolated, or a staircase"),
        option_choice("force", &force, "momentum-exchange|shear-layer",
                      "as it is, or the paper's shear over one voxel without pressure"),
        option_choice("precision", &precision, "double|float", "in which the flow is stored"),
        option_string("beside", "DIR,DIR", &folders, "folders of earlier runs, to draw beside"),
        option_flag("draw", &drawn, "run nothing: draw the runs of --beside, the first of which is --case"),
    };
    program self = program_start("settling", "Spheres settling in a box, the flow resolved around them.", options,
                                 (int)(sizeof options / sizeof *options), argc, argv);
    const scene *s = &scenes[which];
    beside runs[MOST_BESIDE];
    static track t;
    run r;
    memset(&r, 0, sizeof r);
    if (is_given(&self, "tau") && !(chosen.tau > 0.5))
        program_refuse(&self, "tau", NULL, "a number above 0.5 and at most 10");
    chosen.field = 1e-3 * field, chosen.until_bottom = until == 0, chosen.half_way = boundary,
    chosen.paper_force = force, chosen.float_storage = precision;
    r.s = s, r.choice = completed(&self, s, chosen, voxel, time, symmetry);
    if (s->diameter / r.choice.voxel < 4.0 || s->width / r.choice.voxel > 2000.0)
        program_refuse(&self, "voxel-um", NULL, "at least 4 voxels a diameter and at most 2000 a width of the box");
    const int n = read_beside(&self, folders, runs);
    for (int i = 0; i < n; i++) runs[i].t->terminal = terminal_velocity(runs[i].t, s->diameter);
    if (drawn && n == 0) program_refuse(&self, "draw", NULL, "with --beside");
    if (drawn) {
        draw(&self, s, runs[0].t, runs + 1, n - 1);
        return common_exit_status();
    }
    progress bar;
    common_interrupt_at_once(true); /* while nothing is written */
    filtration_status status = set_up(&r, &self);
    common_interrupt_at_once(false);
    progress_begin(&bar, s->name, r.choice.time);
    if (status == FILTRATION_OK) status = go(&self, &r, &t, &bar);
    progress_end(&bar);
    if (status != FILTRATION_OK)
        common_fail("%s at %.3g ms: %s%s%s", s->name, 1e3 * r.fluid.time, filtration_status_text(status),
                    status == FILTRATION_DIVERGED ? ": " : "",
                    status == FILTRATION_DIVERGED ? filtration_cause_text(r.fluid.problem.cause) : "");
    if (status == FILTRATION_OK) { /* after Ctrl-C: what it has, but for the file that tells of a whole run */
        json *report = json_open(common_interrupted() ? NULL : self.json);
        t.terminal = terminal_velocity(&t, s->diameter);
        print_run(&r, &t);
        write_track(&self, s, &t);
        draw(&self, s, &t, runs, n);
        report_run(report, &r, &t);
        json_program(report, &self);
        json_close(report);
    }
    for (int i = 0; i < n; i++) free(runs[i].t);
    filtration_fluid_free(&r.fluid);
    return common_exit_status();
}
