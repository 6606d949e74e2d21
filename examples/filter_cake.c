/* A filter cake that grows on a woven wire cloth, the flow resolved around wires and spheres, by filtration.h.

   filter_cake               2/2 twill of 28 um wires and 32 um openings, glass spheres of 55 to 109 um, 1e11 1/m3 in
                             water, 1000 Pa, 98 ms: Puderbach, Schmidt & Antonyuk, Processes 9 (2021) 826 ("the paper"),
                             a box of 480 um
   filter_cake --unit-cell   a box of 240 um, the smallest that repeats: a quarter of the spheres
   filter_cake --short       the clean cloth up to its resistance and the first spheres, in less than a minute
   Your own particles:       --sizes sizes.csv     columns diameter_um and number_share, volume_share or q3
   Long runs:                --checkpoint FILE --stop-ms 20, then --resume FILE: the same bits as without a stop

   A run that Ctrl-C ends writes what it has, but for --json.

   series.csv and velocity.svg (filtrate velocity in time), curve.svg (t / V over V, scaled to 20 cm2, with its line),
   spheres.svg (height and velocity of each), slice.svg (speed in a cut), particles.pvd and flow.pvd for ParaView: the
   paper's Figs 18 to 21. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "filtration.h"

enum { MOST_CLASSES = 64, MOST_SPHERES = 4096, MOST_SAMPLES = 2000, INSERT_TRIES = 50 };
static const double touching = 0.02; /* gap over the diameter up to which two spheres touch */

/* ---- what is simulated ---- */

typedef struct duty {
    double wire, opening, pressure, viscosity, density, solid_density, concentration; /* SI */
    double width, height, centre;                     /* of the box; height of the cloth in it [m] */
    double voxel, tau, fastest_tau, bulk_ratio, time; /* tau at the start and later */
    double magic, ramp;                               /* [-]; time in which the pressure comes [s] */
    double first_share; /* of the pressure at the start: 1, or less where the lattice would not resolve the jets through
                           the clean cloth */
    int twill, paper_force, half_way, classes;
    double diameter[MOST_CLASSES], share[MOST_CLASSES]; /* by number, adding up to 1 */
} duty;

/* Lambda of the two relaxation times. Fast jets need the smaller one, which damps what the lattice does not resolve.
   The clean cloth then resists more, by a quarter where pores are four voxels wide, by 15 % where they are ten, so it
   goes once the cake has slowed the jets. */
static const double exact_magic = 3.0 / 16.0, jet_magic = 0.03;

/* Largest u dx / nu that the lattice resolves: faster jets become unsteady between the wires, and the run stops. */
static const double resolved = 18.0;

/* What viscosity takes from the speed of a jet [m/s]. */
static double jet_friction(const duty *d) {
    return 8.0 * d->viscosity * d->wire / (d->opening * d->opening) / d->density;
}

/* Largest speed in the pores of the clean cloth [m/s]: that of a free jet and a fifth more, less what viscosity takes
   (fitted to the paper's twill from 500 to 5000 Pa). */
static double jet_speed(const duty *d) {
    const double friction = jet_friction(d);
    return sqrt(friction * friction + 1.44 * 2.0 * d->pressure / d->density) - friction;
}

/* Jets above a Reynolds number of the opening of 100 become unsteady (162 did, 78 stayed steady up to the limit of the
   lattice). Others near the limit are damped, too. */
static int has_fast_jets(const duty *d) {
    return d->first_share < 1.0 || jet_speed(d) * d->opening * d->density > 100.0 * d->viscosity;
}

/* From half of the limit on the exact Lambda lets waves of a few nodes grow in such jets until the run stops. */
static int needs_damping(const duty *d, double cell) { return has_fast_jets(d) && cell > 0.5 * resolved; }

/* The paper's numbers; number shares are the specification's conversion of its Figure 9. */
static duty paper_duty(void) {
    static const double um[] = {55, 63, 72, 83, 95, 109}, share[] = {.030, .119, .327, .379, .135, .010};
    duty d;
    memset(&d, 0, sizeof d);
    d.wire = 28e-6, d.opening = 32e-6, d.pressure = 1000.0, d.viscosity = 1e-3, d.density = 1000.0,
    d.solid_density = 2200.0;
    d.concentration = 1e11, d.width = 480e-6, d.height = 1.1e-3, d.centre = 0.14e-3;
    d.voxel = 2.5e-6, d.tau = 0.6, d.fastest_tau = 0.69, d.bulk_ratio = 10.0, d.time = 98e-3;
    d.magic = exact_magic, d.ramp = 0.5e-3, d.first_share = 1.0;
    d.twill = 1, d.classes = 6;
    for (int i = 0; i < 6; i++) d.diameter[i] = 1e-6 * um[i], d.share[i] = share[i];
    return d;
}

/* Classes of a curve Q3, cumulative by volume: between two sizes q3 is constant, and a class has the diameter of its
   mean volume. Returns what is wrong, or NULL. */
static const char *classes_of_curve(const sheet_sizes *data, duty *d) {
    double Q3[MOST_CLASSES + 1], Q0[MOST_CLASSES + 1];
    const double *x = data->size;
    if (data->amount[0][0] > 1e-3 || data->above[0] > 1e-3)
        return "a curve from 0 to 1: its first size passes nothing, its last one everything";
    for (int i = 0; i < data->n; i++) Q3[i] = i > 0 ? data->amount[0][i] / data->amount[0][data->n - 1] : 0.0;
    if (filtration_number_distribution((size_t)data->n, x, Q3, Q0) != FILTRATION_OK)
        return "rising sizes above 0 and a curve that does not fall";
    d->classes = 0;
    for (int i = 1; i < data->n; i++) {
        const double low = 1.0 / x[i - 1], high = 1.0 / x[i];
        if (!(Q0[i] > Q0[i - 1])) continue;
        d->diameter[d->classes] = 1.0 / cbrt(0.5 * low * high * (low + high));
        d->share[d->classes++] = Q0[i] - Q0[i - 1];
    }
    return NULL;
}

static const char *classes_of_shares(const sheet_sizes *data, duty *d) {
    d->classes = data->n;
    for (int i = 0; i < data->n; i++) d->diameter[i] = data->size[i], d->share[i] = data->amount[0][i];
    const double power = data->by_number == 1 ? 0.0 : -3.0;
    if (filtration_convert_shares((size_t)d->classes, d->diameter, d->share, power, d->share) == FILTRATION_OK)
        return NULL;
    return "diameters above 0 and shares of at least 0, not all 0";
}

static void read_sizes(const program *self, const char *path, duty *d) {
    static const char *const wanted = "a file with the columns diameter_um and number_share, volume_share or q3 "
                                      "(cumulative, by volume), up to 64 rows";
    sheet_sizes data;
    char message[600], text[800];
    if (sheet_read_sizes(path, NULL, 1, &data, message, sizeof message) != 0) {
        snprintf(text, sizeof text, "%s; this one: %s", wanted, message);
        program_refuse(self, "sizes", path, text);
    }
    const int below = !data.single; /* of a curve: classes between two sizes */
    if (data.by_number < 0 && data.single) program_refuse(self, "sizes", path, wanted);
    if (data.n - below < 1 || data.n - below > MOST_CLASSES) program_refuse(self, "sizes", path, wanted);
    const char *lacking = below ? classes_of_curve(&data, d) : classes_of_shares(&data, d);
    if (lacking) program_refuse(self, "sizes", path, lacking);
    common_print("%s\n", data.how);
    sheet_free_sizes(&data);
}

/* Two of the largest spheres must find room side by side: a pair touches in one place only. */
static void check_sizes(const program *self, const char *path, const duty *d) {
    double least = HUGE_VAL, most = 0.0;
    char text[200];
    for (int i = 0; i < d->classes; i++) least = fmin(least, d->diameter[i]), most = fmax(most, d->diameter[i]);
    if (least >= 4.0 * d->voxel && most <= 0.5 * d->width) return;
    snprintf(text, sizeof text, "diameters of %.3g um (4 voxels) to %.3g um (half the box); these: %.3g to %.3g um%s",
             4e6 * d->voxel, 0.5e6 * d->width, 1e6 * least, 1e6 * most,
             least < 4.0 * d->voxel ? "; or finer voxels" : "; or no --unit-cell");
    program_refuse(self, "sizes", path, text);
}

/* ---- state: what a checkpoint holds, besides the flow ---- */

typedef struct cake {
    int n;                 /* spheres generated */
    int waiting;           /* spheres due that found no place yet */
    int passed;            /* through the cloth */
    uint64_t random;       /* state of the generator */
    double filtrate, due;  /* volume so far; at which the next sphere comes [m3] */
    double first_touch;    /* time at which a sphere first touched the cloth [s]; < 0: none yet */
    double clean_velocity; /* largest filtrate velocity before that [m/s], over the share of the pressure that acts */
    double share;          /* of the pressure that acts after the ramp [-] */
    double limited_time, limited_filtrate; /* until when, and until what filtrate, it was below 1 [s] [m3] */
    double next_sample;                    /* [s] */
    int samples;
    double time[MOST_SAMPLES], volume[MOST_SAMPLES], velocity[MOST_SAMPLES]; /* [s] [m3] [m/s] */
    double pressure_noise; /* sum of squared changes of the force on resting spheres [N2] */
    int64_t noise_samples;
    double centre[3 * MOST_SPHERES], speed[3 * MOST_SPHERES], spin[3 * MOST_SPHERES], radius[MOST_SPHERES],
        force[3 * MOST_SPHERES], torque[3 * MOST_SPHERES], contact[3 * MOST_SPHERES];
} cake;

typedef struct run {
    duty d;
    filtration_cloth cloth;
    filtration_fluid fluid;
    filtration_motion_def motion;
    filtration_spheres spheres;
    cake *c;
    double seconds;
} run;

static double area(const run *r) { return r->d.width * r->d.width; }

/* Filtrate until the next sphere: arrivals at random, concentration times the filtrate on average. */
static double next_due(cake *c, const duty *d) { return -riddle_log(random_inner(&c->random)) / d->concentration; }

static filtration_fluid_def fluid_def(run *r, int threads) {
    const duty *d = &r->d;
    filtration_fluid_def def = filtration_fluid_default_def();
    def.voxel = d->voxel, def.tau = d->tau, def.bulk_ratio = d->bulk_ratio, def.magic = d->magic, def.threads = threads;
    def.density = d->density, def.viscosity = d->viscosity;
    def.nodes[0] = def.nodes[1] = (int)floor(d->width / d->voxel + 0.5);
    def.nodes[2] = (int)floor(d->height / d->voxel + 0.5);
    def.face[FILTRATION_LOW_Z] = FILTRATION_OUTLET, def.face[FILTRATION_HIGH_Z] = FILTRATION_PRESSURE;
    if (d->paper_force) def.force = FILTRATION_SHEAR_LAYER;
    if (d->half_way) def.boundary = FILTRATION_HALF_WAY;
    def.solid = filtration_cloth_solid(&r->cloth);
    return def;
}

static filtration_status set_up(run *r, const program *self) {
    const duty *d = &r->d;
    r->c = calloc(1, sizeof *r->c);
    if (!r->c) return FILTRATION_NO_MEMORY;
    filtration_cloth_make(&r->cloth, d->wire, d->opening, d->twill ? FILTRATION_TWILL_WEAVE : FILTRATION_PLAIN_WEAVE,
                          d->centre);
    const filtration_fluid_def def = fluid_def(r, self->threads);
    r->motion = filtration_motion_default_def();
    r->motion.density = d->solid_density;
    cake *c = r->c;
    c->random = self->seed, c->first_touch = -1.0, c->share = d->first_share;
    c->due = next_due(c, d);
    const filtration_spheres all = {0, c->centre, c->speed, c->spin, c->radius, c->force, c->torque};
    r->spheres = all;
    const char *field = "";
    if (filtration_fluid_check_def(&def, &field) != FILTRATION_OK && strcmp(field, "nodes") == 0)
        program_refuse(self, "voxel-um", NULL, "larger ones: these are more than a lattice can count");
    program_need_memory(self, "voxel-um", filtration_fluid_bytes(&def));
    return filtration_fluid_init(&r->fluid, &def);
}

/* ---- spheres ---- */

static double across(const run *r, double away) { return away - r->d.width * floor(away / r->d.width + 0.5); }

static double gap_of(const run *r, int i, int j) {
    const double *a = r->c->centre + 3 * i, *b = r->c->centre + 3 * j;
    const double x = across(r, a[0] - b[0]), y = across(r, a[1] - b[1]), z = a[2] - b[2];
    return sqrt(x * x + y * y + z * z) - r->c->radius[i] - r->c->radius[j];
}

/* Puts a sphere of a random class below the inlet where it overlaps none. 0: no place. */
static int insert(run *r, double velocity) {
    cake *c = r->c;
    double place = random_inner(&c->random);
    int class = 0;
    while (class + 1 < r->d.classes && place >= r->d.share[class]) place -= r->d.share[class ++];
    const int i = c->n;
    c->radius[i] = 0.5 * r->d.diameter[class];
    for (int attempt = 0; attempt < INSERT_TRIES; attempt++) {
        c->centre[3 * i] = r->d.width * random_inner(&c->random),
                      c->centre[3 * i + 1] = r->d.width * random_inner(&c->random);
        c->centre[3 * i + 2] = r->d.height - c->radius[i] - 2.0 * r->d.voxel;
        int free_place = 1;
        for (int j = 0; j < i && free_place; j++) free_place = !(c->radius[j] > 0.0 && gap_of(r, i, j) < r->d.voxel);
        if (!free_place) continue;
        c->speed[3 * i + 2] = -velocity;
        r->spheres.n = c->n = i + 1;
        return 1;
    }
    c->radius[i] = 0.0;
    return 0;
}

/* Spheres come with the suspension, and those that have passed the cloth leave. */
static void feed(run *r, double velocity) {
    cake *c = r->c;
    for (; c->filtrate >= c->due; c->due += next_due(c, &r->d)) c->waiting++;
    while (c->waiting > 0 && c->n < MOST_SPHERES && insert(r, velocity)) c->waiting--;
    for (int i = 0; i < c->n; i++) {
        if (!(c->radius[i] > 0.0 && c->centre[3 * i + 2] < c->radius[i] + r->d.voxel)) continue;
        c->radius[i] = 0.0;
        c->passed++;
    }
}

/* Marks spheres that hang together with the cloth; returns their number. */
static int mark_cake(const run *r, char *in_cake) {
    const cake *c = r->c;
    int found = 0, before = -1;
    for (int i = 0; i < c->n; i++) {
        in_cake[i] = c->radius[i] > 0.0 && filtration_cloth_distance(&r->cloth, c->centre + 3 * i) - c->radius[i] <
                                               2.0 * touching * c->radius[i];
        found += in_cake[i];
    }
    while (found != before) {
        before = found;
        for (int i = 0; i < c->n; i++)
            for (int j = 0; j < c->n && !in_cake[i] && c->radius[i] > 0.0; j++)
                if (in_cake[j] && gap_of(r, i, j) < touching * (c->radius[i] + c->radius[j])) in_cake[i] = 1, found++;
    }
    return found;
}

/* The cake as the spheres say: its height is twice the height of its centre of volume over the cloth. */
typedef struct cake_shape {
    int deposited, settling;
    double solid, height, top, porosity, sauter; /* [m3] [m] [m] [-] [m] */
} cake_shape;

static cake_shape measure_cake(const run *r) {
    static char in_cake[MOST_SPHERES];
    const cake *c = r->c;
    const double surface = r->d.centre + r->d.wire;
    cake_shape s;
    double moment = 0.0, squares = 0.0, cubes = 0.0;
    memset(&s, 0, sizeof s);
    s.deposited = mark_cake(r, in_cake);
    for (int i = 0; i < c->n; i++) {
        if (!(c->radius[i] > 0.0)) continue;
        const double R = c->radius[i], volume = 4.0 / 3.0 * RIDDLE_PI * R * R * R,
                     above = c->centre[3 * i + 2] - surface;
        if (!in_cake[i]) {
            s.settling++;
            continue;
        }
        s.solid += volume, moment += volume * above, squares += R * R, cubes += R * R * R;
        s.top = fmax(s.top, above + R);
    }
    s.height = s.solid > 0.0 ? 2.0 * moment / s.solid : 0.0;
    s.porosity = s.height > 0.0 ? 1.0 - s.solid / (area(r) * s.height) : (double)NAN;
    s.sauter = squares > 0.0 ? 2.0 * cubes / squares : (double)NAN;
    return s;
}

/* ---- checkpoints ---- */

static const char mark[8] = "CAKE0003";

static int write_bytes(void *user, const void *data, size_t bytes) { return riddle_io_write(user, data, bytes) == 0; }
static int read_bytes(void *user, void *data, size_t bytes) { return fread(data, 1, bytes, user) == bytes; }

static int save(const run *r, const char *path) {
    riddle_io_file *file = riddle_io_open(NULL, path);
    if (!file) return -1;
    riddle_io_write(file, mark, sizeof mark), riddle_io_write(file, &r->d, sizeof r->d),
        riddle_io_write(file, r->c, sizeof *r->c);
    if (filtration_fluid_save(&r->fluid, write_bytes, file) != FILTRATION_OK) {
        riddle_io_discard(file);
        return common_fail("%s could not be written", path);
    }
    return (int)riddle_io_close(file);
}

/* Into a run that is set up from the duty in the file, but for the time to which it shall go. */
static filtration_status resume(const program *self, run *r, const char *path, double until) {
    char found[sizeof mark];
    duty d = r->d;
    FILE *file = fopen(path, "rb");
    if (!file || fread(found, 1, sizeof found, file) != sizeof found || memcmp(found, mark, sizeof mark) != 0 ||
        fread(&d, 1, sizeof d, file) != sizeof d)
        program_refuse(self, "resume", path, "a checkpoint that this program wrote");
    r->d = d;
    if (until > 0.0) r->d.time = until;
    filtration_status status = set_up(r, self);
    if (status == FILTRATION_OK && fread(r->c, 1, sizeof *r->c, file) != sizeof *r->c) status = FILTRATION_BAD_DATA;
    if (status == FILTRATION_OK) status = filtration_fluid_load(&r->fluid, read_bytes, file);
    fclose(file);
    if (status == FILTRATION_BAD_DATA || status == FILTRATION_STREAM)
        program_refuse(self, "resume", path, "a checkpoint that this program wrote, whole");
    r->spheres.n = r->c->n;
    return status;
}

/* ---- the run ---- */

/* The pressure comes in a ramp: at once it would send a wave through the pores. */
static filtration_status set_pressure(run *r) {
    const double part = fmin(r->fluid.time / r->d.ramp, 1.0), p = 0.5 * part * r->c->share * r->d.pressure;
    if (r->fluid.def.face_pressure[FILTRATION_HIGH_Z] == p) return FILTRATION_OK;
    const filtration_status status = filtration_fluid_set_face_pressure(&r->fluid, FILTRATION_HIGH_Z, p);
    return status == FILTRATION_OK ? filtration_fluid_set_face_pressure(&r->fluid, FILTRATION_LOW_Z, -p) : status;
}

/* A longer time step once the pores are clogged, a shorter one for a fast flow: lattice speed at most 0.1 and density
   difference at most 0.08. */
static filtration_status choose_step(run *r) {
    const double speed = filtration_fluid_max_speed(&r->fluid) * r->fluid.dt / r->d.voxel;
    const double now = r->fluid.def.tau;
    if (!(speed > 0.0)) return FILTRATION_OK;
    double tau = 0.5 + (now - 0.5) * 0.1 / speed;
    tau = fmin(fmax(tau, 0.5 + 0.5 * (r->d.tau - 0.5)), r->fluid.time < 4.0 * r->d.ramp ? r->d.tau : r->d.fastest_tau);
    return tau > 1.1 * (now - 0.5) + 0.5 || tau < now ? filtration_fluid_set_tau(&r->fluid, tau) : FILTRATION_OK;
}

/* Where the jets through the clean cloth are too fast for the lattice, part of the pressure waits for the cake, as with
   a pump of limited rate. */
static filtration_status follow_jets(run *r) {
    cake *c = r->c;
    if (!has_fast_jets(&r->d)) return FILTRATION_OK;
    const double cell = filtration_fluid_max_speed(&r->fluid) * r->d.voxel * r->d.density / r->d.viscosity;
    if (r->d.first_share < 1.0 && r->fluid.time >= r->d.ramp) {
        c->share = fmin(c->share * (cell < 0.95 * resolved ? 1.01 : cell > resolved ? 0.98 : 1.0), 1.0);
        if (c->share < 1.0) c->limited_time = r->fluid.time, c->limited_filtrate = c->filtrate;
    }
    const double magic = c->share < 1.0 || needs_damping(&r->d, cell) ? jet_magic : exact_magic;
    if (magic == r->d.magic) return FILTRATION_OK;
    r->d.magic = r->fluid.def.magic = magic;
    return filtration_fluid_set_tau(&r->fluid, r->fluid.def.tau);
}

/* Mean square change of the force on touching spheres from one step to the next: what sound of the moving
   surfaces adds. */
static void listen(cake *c, const double *before) {
    for (int i = 0; i < c->n; i++) {
        if (!(c->radius[i] > 0.0)) continue;
        for (int k = 0; k < 3; k++) {
            const double change = c->force[3 * i + k] - before[3 * i + k];
            c->pressure_noise += change * change;
        }
        c->noise_samples++;
    }
}

static filtration_status step(run *r) {
    static double before[3 * MOST_SPHERES];
    cake *c = r->c;
    memcpy(before, c->force, sizeof(double) * 3 * (size_t)c->n);
    const int listened = c->n;
    filtration_status status = set_pressure(r);
    if (status == FILTRATION_OK) status = filtration_fluid_step(&r->fluid, &r->spheres);
    if (status == FILTRATION_OK) status = filtration_move(&r->motion, &r->fluid, &r->spheres, 1.0, c->contact);
    if (status != FILTRATION_OK) return status;
    if (listened > 0) listen(c, before);
    if (r->fluid.steps % 16 != 0) return FILTRATION_OK; /* the filtrate changes little from step to step */
    const double velocity = -filtration_fluid_flux(&r->fluid, 2, 1), span = 16.0 * r->fluid.dt;
    c->filtrate += fmax(velocity, 0.0) * area(r) * span;
    feed(r, fmax(velocity, 0.0));
    for (int i = 0; i < c->n && c->first_touch < 0.0; i++)
        if (c->radius[i] > 0.0 &&
            filtration_cloth_distance(&r->cloth, c->centre + 3 * i) < (1.0 + 2.0 * touching) * c->radius[i])
            c->first_touch = r->fluid.time;
    if (c->first_touch < 0.0) c->clean_velocity = fmax(c->clean_velocity, velocity / c->share);
    if (r->fluid.steps % 64 == 0) status = follow_jets(r);
    if (status != FILTRATION_OK) return status;
    if (r->fluid.time >= c->next_sample && c->samples < MOST_SAMPLES) {
        c->time[c->samples] = r->fluid.time, c->volume[c->samples] = c->filtrate, c->velocity[c->samples++] = velocity;
        c->next_sample += r->d.time / MOST_SAMPLES * 1.01;
    }
    return r->fluid.steps % (r->fluid.time < 2.0 * r->d.ramp ? 64 : 512) == 0 ? choose_step(r) : FILTRATION_OK;
}

/* ---- ParaView ---- */

typedef struct films {
    riddle_io_series *particles, *flow;
    double every, next; /* [s] */
    int with_flow;
} films;

static void film_particles(const program *self, const run *r, films *f) {
    static double diameter[MOST_SPHERES];
    static char in_cake[MOST_SPHERES];
    static int deposited[MOST_SPHERES];
    const cake *c = r->c;
    mark_cake(r, in_cake);
    for (int i = 0; i < c->n; i++) diameter[i] = 2.0 * c->radius[i], deposited[i] = in_cake[i];
    const riddle_io_array arrays[] = {
        riddle_io_scalar("diameter_m", diameter),        riddle_io_vector("velocity_m_per_s", c->speed),
        riddle_io_vector("force_n", c->force),           riddle_io_vector("torque_n_m", c->torque),
        riddle_io_vector("contact_force_n", c->contact), riddle_io_ints("deposited", deposited)};
    riddle_io_points(self->out, riddle_io_series_name(f->particles, r->fluid.time), c->n,
                     riddle_io_vector("position_m", c->centre), arrays, 6);
}

static void film_flow(const program *self, const run *r, films *f) {
    const int *n = r->fluid.def.nodes;
    const size_t nodes = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    const double origin[3] = {0.0, 0.0, 0.0}, spacing[3] = {r->d.voxel, r->d.voxel, r->d.voxel};
    float *velocity = malloc(5 * nodes * sizeof *velocity);
    int32_t *owner = malloc(nodes * sizeof *owner);
    if (velocity && owner) {
        float *pressure = velocity + 3 * nodes, *speed = velocity + 4 * nodes;
        filtration_fluid_fields(&r->fluid, velocity, pressure, owner);
        for (size_t i = 0; i < nodes; i++)
            speed[i] = sqrtf(velocity[3 * i] * velocity[3 * i] + velocity[3 * i + 1] * velocity[3 * i + 1] +
                             velocity[3 * i + 2] * velocity[3 * i + 2]);
        const riddle_io_array arrays[] = {riddle_io_scalar_float("speed_m_per_s", speed),
                                          riddle_io_scalar_float("pressure_pa", pressure),
                                          riddle_io_ints("owner", (const int *)owner)};
        riddle_io_cells(self->out, riddle_io_series_name_as(f->flow, r->fluid.time, "vti"), n, origin, spacing, arrays,
                        3);
    } else common_fail("out of memory for the flow's file");
    free(velocity), free(owner);
}

static void film(const program *self, const run *r, films *f) {
    film_particles(self, r, f);
    if (f->with_flow) film_flow(self, r, f);
    f->next += f->every;
}

/* ---- results ---- */

/* What the filter curve gives, scaled to 20 cm2. */
typedef struct findings {
    filtration_curve curve;
    filtration_status evaluated;
    cake_shape shape;
    double clean, product, specific, by_filtrate, by_height, by_end, kozeny, noise;
} findings;

static const double laboratory = 20e-4; /* area of the paper's filter [m2] */

static findings evaluate(const run *r) {
    findings f;
    const cake *c = r->c;
    static double V[MOST_SAMPLES];
    memset(&f, 0, sizeof f);
    f.shape = measure_cake(r);
    f.clean = filtration_resistance(r->d.pressure, r->d.viscosity, c->clean_velocity);
    for (int i = 0; i < c->samples; i++) V[i] = c->volume[i] * laboratory / area(r);
    filtration_curve_def def = filtration_curve_default_def();
    def.pressure = r->d.pressure, def.viscosity = r->d.viscosity, def.area = laboratory;
    def.first_volume = fmax(2e-6, c->limited_filtrate * laboratory / area(r));
    f.evaluated = filtration_evaluate(&def, (size_t)c->samples, c->time, V, &f.curve);
    f.product = f.evaluated == FILTRATION_OK ? f.curve.product.value : (double)NAN;
    double suspended = 0.0; /* share of solid in the suspension */
    for (int i = 0; i < r->d.classes; i++)
        suspended += r->d.concentration * r->d.share[i] * RIDDLE_PI / 6.0 * pow(r->d.diameter[i], 3.0);
    f.by_filtrate = filtration_cake_ratio(suspended, f.shape.porosity);
    f.by_height = filtration_cake_ratio_of_height(f.shape.height, area(r), c->filtrate);
    f.specific = f.product / f.by_height;
    const double last = c->samples > 0 ? c->velocity[c->samples - 1] : (double)NAN;
    f.by_end = f.shape.height > 0.0
                   ? (filtration_resistance(c->share * r->d.pressure, r->d.viscosity, last) - f.clean) / f.shape.height
                   : (double)NAN;
    f.kozeny = filtration_kozeny_carman(f.shape.porosity, f.shape.sauter, FILTRATION_KOZENY_CARMAN);
    f.noise = c->noise_samples > 0 ? sqrt(c->pressure_noise / (double)c->noise_samples) : 0.0;
    return f;
}

static void report_run(json *report, const run *r, const findings *f) {
    const cake *c = r->c;
    const int *n = r->fluid.def.nodes;
    results_values(
        report, {"r_m0_per_m", f->clean},
        {"r_m_per_m", f->evaluated == FILTRATION_OK ? f->curve.medium.value : (double)NAN},
        {"r_k_k_s_per_m2", f->product},
        {"r_k_k_s_low_per_m2", f->evaluated == FILTRATION_OK ? f->curve.product.low : (double)NAN},
        {"r_k_k_s_high_per_m2", f->evaluated == FILTRATION_OK ? f->curve.product.high : (double)NAN},
        {"r_k_per_m2", f->specific}, {"r_k_end_per_m2", f->by_end}, {"k_s_filtrate", f->by_filtrate},
        {"k_s_height", f->by_height}, {"r_k_kozeny_per_m2", f->kozeny}, {"particles_generated", c->n},
        {"particles_deposited", f->shape.deposited}, {"particles_settling", f->shape.settling},
        {"particles_passed", c->passed}, {"t_first_particle_s", c->first_touch >= 0.0 ? c->first_touch : (double)NAN},
        {"cake_height_m", f->shape.height}, {"cake_top_m", f->shape.top}, {"cake_porosity", f->shape.porosity},
        {"sauter_diameter_m", f->shape.sauter}, {"force_noise_n", f->noise},
        {"pressure_limited_until_s", c->limited_time}, {"pressure_share_at_the_end", c->share});
    json_array(report, "time_s", c->time, c->samples);
    json_array(report, "filtrate_velocity_m_per_s", c->velocity, c->samples);
    json_array(report, "filtrate_m3", c->volume, c->samples);
    results_values(report, {"voxel_m", r->d.voxel}, {"box_m", r->d.width}, {"tau", r->fluid.def.tau},
                   {"bulk_ratio", r->d.bulk_ratio}, {"nodes", (double)n[0] * n[1] * n[2]},
                   {"steps", (double)r->fluid.steps}, {"run_s", r->seconds},
                   {"mlups", r->seconds > 0.0 ? 1e-6 * (double)r->fluid.updates / r->seconds : 0.0});
}

static void print_run(const run *r, const findings *f) {
    const cake *c = r->c;
    common_print("%.4g ms, %.3g mL over 20 cm2, %lld steps in %.1f s: %.0f MLUPS\n\n", 1e3 * r->fluid.time,
                 1e6 * c->filtrate * laboratory / area(r), (long long)r->fluid.steps, r->seconds,
                 r->seconds > 0.0 ? 1e-6 * (double)r->fluid.updates / r->seconds : 0.0);
    riddle_io_table t = riddle_io_table_begin("|here|paper|");
    const double line = f->evaluated == FILTRATION_OK ? f->curve.medium.value : (double)NAN;
    const struct {
        const char *name, *paper, *unit;
        double value;
    } rows[] = {{"clean medium R_M0, from the largest filtrate velocity", "3.4e6", "1/m", f->clean},
                {"medium R_M, from the line", "", "1/m", line},
                {"r_K K_S, from the line", "", "1/m2", f->product},
                {"K_S, from the height", "", "-", f->by_height},
                {"K_S, from suspension and porosity", "", "-", f->by_filtrate},
                {"specific cake resistance r_K", "7.8e10", "1/m2", f->specific},
                {"r_K from the last velocity, less R_M0, over the height", "", "1/m2", f->by_end},
                {"r_K by Kozeny and Carman", "", "1/m2", f->kozeny},
                {"cake height (twice its centre of volume)", "0.5", "mm", 1e3 * f->shape.height},
                {"cake porosity", "", "-", f->shape.porosity},
                {"first sphere on the cloth", "3.9", "ms", c->first_touch >= 0.0 ? 1e3 * c->first_touch : (double)NAN},
                {"spheres generated (paper: 480 um box, 98 ms)", "161", "", c->n},
                {"of them in the cake", "145", "", f->shape.deposited},
                {"still settling", "16", "", f->shape.settling}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        riddle_io_table_cell(&t, "%s", rows[i].name), riddle_io_table_cell(&t, "%.4g", rows[i].value);
        riddle_io_table_cell(&t, "%s", rows[i].paper), riddle_io_table_cell(&t, "%s", rows[i].unit);
    }
    table_end(&t);
    if (r->d.first_share < 1.0)
        common_print("The lattice does not resolve the jets of the whole pressure through the clean cloth: %.3g Pa at "
                     "the start, less than the "
                     "whole until %.3g ms, as with a pump of limited rate; the line begins after that.\n",
                     r->d.first_share * r->d.pressure, 1e3 * c->limited_time);
    if (needs_damping(&r->d, jet_speed(&r->d) * r->d.voxel * r->d.density / r->d.viscosity))
        common_print("R_M0 is too high, because fast jets were damped: by 15 %% where pores are ten voxels wide, by a "
                     "quarter where they are four. Finer voxels or a lower pressure give it.\n");
    if (f->evaluated != FILTRATION_OK) common_print("No line: %s\n", filtration_status_text(f->evaluated));
    else if (line < 0.0)
        common_print("R_M from the line is below 0, which no medium has: the first spheres clog pores, and the line "
                     "counts that as cake. Use R_M0.\n");
}

/* ---- figures ---- */

static void draw_curves(const program *self, const run *r, const findings *f) {
    const cake *c = r->c;
    static double ms[MOST_SAMPLES], V[MOST_SAMPLES], ratio[MOST_SAMPLES], line[MOST_SAMPLES];
    riddle_io_file *file =
        csv_open(self->out, "series.csv", "time_s,filtrate_m3,filtrate_velocity_m_per_s,volume_20cm2_m3");
    for (int i = 0; i < c->samples; i++) {
        ms[i] = 1e3 * c->time[i], V[i] = 1e6 * c->volume[i] * laboratory / area(r), ratio[i] = c->time[i] / V[i];
        line[i] = 1e-6 * (f->curve.intercept.value + f->curve.slope.value * 1e-6 * V[i]);
        const double cells[4] = {c->time[i], c->volume[i], c->velocity[i], 1e-6 * V[i]};
        riddle_io_row(file, cells, 4);
    }
    riddle_io_close(file);
    riddle_plot *figure = riddle_plot_new("Filtrate velocity", 1, 1);
    riddle_plot_panel(figure, 0, 0, "time [ms]", "filtrate velocity [m/s]");
    riddle_plot_line(figure, "", ms, c->velocity, c->samples);
    if (c->first_touch >= 0.0) riddle_plot_vertical(figure, "first sphere on the cloth", 1e3 * c->first_touch);
    riddle_plot_write(figure, self->out, "velocity.svg");
    if (c->first_touch < 0.0) {
        figure_left_out(self->out, "curve.svg", "no sphere has reached the cloth");
        return;
    }
    figure = riddle_plot_new("Filter curve", 1, 1);
    riddle_plot_panel(figure, 0, 0, "filtrate over 20 cm² [mL]", "t / V [s/mL]");
    double high = 0.0; /* of what the cake shows; while the flow begins t/V is far higher */
    for (int i = 0; i < c->samples; i++) high = c->time[i] < c->first_touch ? high : fmax(high, ratio[i]);
    riddle_plot_range_y(figure, f->evaluated == FILTRATION_OK ? fmin(0.0, 1.1 * line[0]) : 0.0, 1.1 * high);
    riddle_plot_line(figure, "simulated", V, ratio, c->samples);
    if (f->evaluated == FILTRATION_OK) {
        riddle_plot_line(figure, "line of the stretch chosen", V, line, c->samples);
        riddle_plot_style(figure, RIDDLE_PLOT_DASHED, RIDDLE_PLOT_NEXT);
    }
    riddle_plot_horizontal(figure, "clean cloth", 1e-6 * r->d.viscosity * f->clean / (laboratory * r->d.pressure));
    riddle_plot_write(figure, self->out, "curve.svg");
}

static void draw_spheres(const program *self, const run *r) {
    const cake *c = r->c;
    static double height[2][MOST_SPHERES], speed[2][MOST_SPHERES];
    static char in_cake[MOST_SPHERES];
    int n[2] = {0, 0};
    mark_cake(r, in_cake);
    for (int i = 0; i < c->n; i++) {
        if (!(c->radius[i] > 0.0)) continue;
        const int k = in_cake[i] != 0;
        const double *v = c->speed + 3 * i;
        height[k][n[k]] = 1e3 * (c->centre[3 * i + 2] - r->d.centre),
        speed[k][n[k]++] = 1e3 * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    }
    if (!n[1]) {
        figure_left_out(self->out, "spheres.svg", "no sphere has reached the cloth");
        return;
    }
    riddle_plot *figure = riddle_plot_new("Velocity of the spheres", 1, 1);
    riddle_plot_panel(figure, 0, 0, "speed [mm/s]", "height over the cloth [mm]");
    riddle_plot_points(figure, "settling", speed[0], height[0], n[0]);
    riddle_plot_points(figure, "in the cake", speed[1], height[1], n[1]);
    riddle_plot_write(figure, self->out, "spheres.svg");
}

/* Speed in the plane y = half the box. */
static void draw_slice(const program *self, const run *r) {
    const int *n = r->fluid.def.nodes;
    double *values = malloc(sizeof(double) * (size_t)n[0] * (size_t)n[2]);
    if (!values) {
        common_fail("out of memory for slice.svg");
        return;
    }
    for (int z = 0; z < n[2]; z++)
        for (int x = 0; x < n[0]; x++) {
            filtration_sample at;
            const bool fluid = filtration_fluid_at(&r->fluid, x, n[1] / 2, z, &at) == FILTRATION_OK && at.owner == -1;
            const double *v = at.velocity;
            values[z * n[0] + x] = fluid ? sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) : (double)NAN;
        }
    riddle_plot *figure = riddle_plot_new("Speed in a cut", 1, 1);
    riddle_plot_panel(figure, 0, 0, "x [mm]", "z [mm]");
    riddle_plot_panel_size(figure, 180.0, 180.0 * fmin(r->d.height / r->d.width, 5.0));
    riddle_plot_heat(figure, "speed [m/s]", values, n[0], n[2], 0.0, 1e3 * r->d.width, 0.0, 1e3 * r->d.height);
    riddle_plot_write(figure, self->out, "slice.svg");
    free(values);
}

/* ---- the command line ---- */

typedef struct typed {
    double voxel, time, stop, pressure, bulk, tau, concentration, wire, opening, frame;
    bool unit, brief, no_flow;
    int force, boundary, weave;
    const char *sizes, *checkpoint, *resume;
} typed;

/* Start step from the largest speed in the pores, with the share of the pressure that the lattice resolves. Refuses
   what has less than a third of it. */
static void choose_start(const program *self, const typed *t, duty *d) {
    const double friction = jet_friction(d), jet = jet_speed(d);
    const double needed = jet * d->voxel * d->density / d->viscosity, cell = fmin(needed, resolved);
    const double reached = cell * d->viscosity / (d->voxel * d->density) + friction;
    char text[300];
    d->first_share =
        needed > resolved ? (reached * reached - friction * friction) * d->density / 2.88 / d->pressure : 1.0;
    if (!(d->first_share >= 1.0 / 3.0)) {
        snprintf(text, sizeof text,
                 "at most %.2g with %.3g um voxels, or voxels of %.2g um: the liquid has about %.2g m/s in the pores",
                 3.0 * d->first_share * d->pressure, 1e6 * d->voxel, 1e6 * d->voxel * resolved / needed, jet);
        program_refuse(self, "pressure-pa", NULL, text);
    }
    if (d->first_share < 1.0) d->magic = jet_magic;
    d->tau = t->tau > 0.0 ? t->tau : fmin(0.5 + 3.0 * 0.12 / cell, 0.6);
    d->fastest_tau = fmax(d->voxel > 4e-6 ? 0.6 : 0.69, d->tau);
}

static duty completed(const program *self, const typed *t) {
    duty d = paper_duty();
    d.twill = t->weave == 0, d.paper_force = t->force, d.half_way = t->boundary;
    d.wire = 1e-6 * t->wire, d.opening = 1e-6 * t->opening, d.pressure = t->pressure,
    d.concentration = t->concentration;
    const double period = (d.wire + d.opening) * (d.twill ? 4.0 : 2.0), below = fmax(5.0 * d.wire, 4.375 * d.opening);
    d.height += below - d.centre, d.centre = below; /* jets must have mixed before they leave the box */
    d.width = (t->unit || t->brief || self->quick ? 1.0 : 2.0) * period;
    d.voxel = t->voxel > 0.0 ? 1e-6 * t->voxel : self->quick ? period / 24.0 : t->brief ? period / 32.0 : 2.5e-6;
    d.time = t->time > 0.0 ? 1e-3 * t->time : self->quick ? 1e-3 : t->brief ? 5e-3 : d.time;
    d.bulk_ratio = t->bulk;
    const double cells = d.width / d.voxel;
    if (!(cells <= 1e5)) program_refuse(self, "voxel-um", NULL, "at least a 100 000th of the box's width");
    if (fabs(cells - floor(cells + 0.5)) > 1e-6 * cells || !(fmin(d.wire, d.opening) >= 2.0 * d.voxel))
        program_refuse(self, "voxel-um", NULL,
                       "a whole part of the box's width (one or two periods of the weave), and at most half a wire and "
                       "half an opening");
    choose_start(self, t, &d);
    if (t->sizes) read_sizes(self, t->sizes, &d);
    check_sizes(self, t->sizes, &d);
    return d;
}

/* Refuses options of the set-up that differ from those of the checkpoint. first: the defaults, which count as not
   given. */
static void check_resumed(const program *self, const typed *t, const typed *first, const duty *d) {
    const struct {
        const char *name;
        double given, unless, before, unit;
    } numbers[] = {{"pressure-pa", t->pressure, first->pressure, d->pressure, 1.0},
                   {"wire-um", t->wire, first->wire, d->wire, 1e-6},
                   {"opening-um", t->opening, first->opening, d->opening, 1e-6},
                   {"voxel-um", t->voxel, first->voxel, d->voxel, 1e-6},
                   {"concentration", t->concentration, first->concentration, d->concentration, 1.0},
                   {"bulk-ratio", t->bulk, first->bulk, d->bulk_ratio, 1.0},
                   {"weave", t->weave, first->weave, d->twill ? 0.0 : 1.0, 1.0},
                   {"force", t->force, first->force, d->paper_force, 1.0},
                   {"boundary", t->boundary, first->boundary, d->half_way, 1.0}};
    char text[100];
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
        if (numbers[k].given == numbers[k].unless ||
            fabs(numbers[k].given * numbers[k].unit - numbers[k].before) <= 1e-9 * numbers[k].before)
            continue;
        snprintf(text, sizeof text, k < 6 ? "that of the checkpoint, %.6g, or none" : "that of the checkpoint, or none",
                 numbers[k].before / numbers[k].unit);
        program_refuse(self, numbers[k].name, NULL, text);
    }
    if (t->sizes) program_refuse(self, "sizes", NULL, "those of the checkpoint: leave it out with --resume");
    if (t->tau > 0.0) program_refuse(self, "tau", NULL, "that of the checkpoint: leave it out with --resume");
}

static filtration_status go(const program *self, run *r, const typed *t, double stop, films *f) {
    const double began = machine_seconds();
    progress bar;
    filtration_status status = FILTRATION_OK;
    int64_t saved = -1; /* the step of the last checkpoint */
    progress_begin(&bar, "filtering", stop);
    while (status == FILTRATION_OK && r->fluid.time < stop && !common_interrupted()) {
        status = step(r);
        if (status == FILTRATION_OK && r->fluid.time >= f->next) {
            film(self, r, f);
            saved = r->fluid.steps;
            if (t->checkpoint && save(r, t->checkpoint) != 0) break;
        }
        if (r->fluid.steps % 16 == 0) progress_update(&bar, r->fluid.time);
    }
    progress_end(&bar);
    r->seconds = machine_seconds() - began;
    if (status != FILTRATION_OK)
        common_fail("at %.4g ms: %s%s%s", 1e3 * r->fluid.time, filtration_status_text(status),
                    status == FILTRATION_DIVERGED ? ": " : "",
                    status == FILTRATION_DIVERGED ? filtration_cause_text(r->fluid.problem.cause) : "");
    else if (t->checkpoint && saved != r->fluid.steps) save(r, t->checkpoint);
    return status;
}

int main(int argc, char **argv) {
    typed t;
    memset(&t, 0, sizeof t);
    t.pressure = 1000.0, t.bulk = 10.0, t.concentration = 1e11, t.wire = 28.0, t.opening = 32.0;
    const typed first = t;
    option options[] = {
        option_flag("unit-cell", &t.unit, "a box of one period of the weave, 240 um, instead of two"),
        option_flag("short", &t.brief, "unit cell, 7.5 um voxels, 5 ms: clean cloth and first spheres"),
        option_positive("voxel-um", "L", &t.voxel, 1e3,
                        "edge of a voxel [um]; default 2.5. Drag on spheres of 4 to 5 voxels is "
                        "-13 to +5 % off"),
        option_positive("time-ms", "T", &t.time, 1e6, "time to filter [ms]; default 98"),
        option_positive("stop-ms", "T", &t.stop, 1e6, "stop before that [ms], with --checkpoint"),
        option_string("checkpoint", "FILE", &t.checkpoint,
                      "write the state there with every frame, at the end, and after Ctrl-C"),
        option_string("resume", "FILE", &t.resume,
                      "go on from there; options that change the set-up of the first run are refused"),
        option_string("sizes", "FILE", &t.sizes,
                      "own particles: CSV with diameter_um and number_share, volume_share or q3 (cumulative by volume, "
                      "% or 0 to 1)"),
        option_positive("concentration", "CN", &t.concentration, 1e14, "spheres in the suspension [1/m3]"),
        option_positive("pressure-pa", "DP", &t.pressure, 1e5, "pressure difference [Pa]"),
        option_positive("wire-um", "D", &t.wire, 1e4, "diameter of the wires [um]"),
        option_positive("opening-um", "W", &t.opening, 1e4, "opening between them [um]"),
        option_choice("weave", &t.weave, "twill|plain", "2/2 twill or plain weave"),
        option_choice("force", &t.force, "momentum-exchange|shear-layer",
                      "as it is, or the paper's shear over one voxel without pressure"),
        option_choice("boundary", &t.boundary, "central-linear|half-way", "surfaces interpolated, or as a staircase"),
        option_double("bulk-ratio", "B", &t.bulk, 0.0, 100.0,
                      "bulk viscosity over kinematic viscosity [-]: damps sound"),
        option_positive("tau", "TAU", &t.tau, 2.0,
                        "relaxation time at the start [-], above 0.5; default: from pressure, opening and voxel"),
        option_positive("frame-ms", "T", &t.frame, 1e6,
                        "time between two ParaView files [ms]; default a twentieth of the run"),
        option_flag("no-flow", &t.no_flow, "ParaView files of the spheres only"),
    };
    program self = program_start(
        "filter_cake", "A filter cake growing on a woven wire cloth, the flow resolved around wires and spheres.",
        options, (int)(sizeof options / sizeof *options), argc, argv);
    run r;
    films f;
    memset(&r, 0, sizeof r), memset(&f, 0, sizeof f);
    if (t.tau > 0.0 && !(t.tau > 0.5)) program_refuse(&self, "tau", NULL, "a number above 0.5 and at most 2");
    if (t.stop > 0.0 && !t.checkpoint) program_refuse(&self, "stop-ms", NULL, "only with --checkpoint");
    filtration_status status;
    common_interrupt_at_once(true); /* 2.5 um voxels take half a minute to set up; nothing is written yet */
    if (t.resume) {
        status = resume(&self, &r, t.resume, 1e-3 * t.time);
        check_resumed(&self, &t, &first, &r.d);
    } else {
        r.d = completed(&self, &t);
        status = set_up(&r, &self);
    }
    common_interrupt_at_once(false);
    const double stop = t.stop > 0.0 ? fmin(1e-3 * t.stop, r.d.time) : r.d.time;
    f.every = t.frame > 0.0 ? 1e-3 * t.frame : r.d.time / (self.quick ? 2.0 : 20.0);
    f.next = f.every * floor(r.fluid.time / f.every + 1.0), f.with_flow = !t.no_flow;
    if (status == FILTRATION_OK) {
        f.particles = riddle_io_series_open(self.out, "particles.pvd");
        if (f.with_flow) f.flow = riddle_io_series_open(self.out, "flow.pvd");
        status = go(&self, &r, &t, stop, &f);
        riddle_io_series_close(f.particles), riddle_io_series_close(f.flow);
    } else common_fail("%s", filtration_status_text(status));
    if (status == FILTRATION_OK && (r.c->samples > 0 || !common_interrupted())) {
        const findings found = evaluate(&r);
        json *report = json_open(common_interrupted() ? NULL : self.json); /* which tells of a whole run */
        print_run(&r, &found);
        draw_curves(&self, &r, &found);
        draw_spheres(&self, &r);
        draw_slice(&self, &r);
        report_run(report, &r, &found);
        json_program(report, &self);
        json_close(report);
    }
    filtration_fluid_free(&r.fluid);
    free(r.c);
    return common_exit_status();
}
