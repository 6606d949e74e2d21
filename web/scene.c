/* scene.c - the wet screen of the page: 2000 spheres of three sizes on a vibrating screen, and the models fitted to
   what is left on it. The same file is compiled to WebAssembly and, by native.c, for this machine: the bits must
   be the same. */
#include "dem_wet.h"
#include "../screen_models.h"

#ifdef __wasm__
#define EXPORT(name) __attribute__((export_name(#name)))
#else
#define EXPORT(name)
#endif

enum { CLASSES = 3, SPHERES = 2000, SAMPLES = 400, MODELS = 3, CURVE = 100, FIT_POINTS = 40 };
static const double RADIUS = 0.07, WIRE = 1.5e-3, STIFFNESS = 1000.0, DENSITY = 2534.1, SAMPLE = 0.01,
                    DT = 2e-5; /* [m] [N/m] [kg/m3] [s] */
static const int number[CLASSES] = {1100, 600, 300};

typedef struct settings {
    double amplitude, frequency, moisture, aperture, diameter[CLASSES]; /* [m], [Hz], [-], [m] */
} settings;

typedef struct live {
    settings now;
    dem_world world;
    wet_scene wet;
    int deck, group[SPHERES], fed[CLASSES], left[CLASSES];
    double sphere[SPHERES]; /* diameters by id [m] */
    double changed_at;      /* time at which the vibration began [s] */
    int samples;
    double time[SAMPLES], retained[CLASSES][SAMPLES];
    float points[5 * SPHERES]; /* x, y, z, radius, class of what is there */
    double curve[MODELS][CLASSES][CURVE], deviation[MODELS], curve_time[CURVE];
    int curve_classes;
} live;
static live s;

static dem_status add_walls(int steel) {
    dem_screen screen = dem_default_screen();
    screen.aperture = s.now.aperture, screen.wire = WIRE, screen.half_x = RADIUS, screen.profile = DEM_ROUND;
    s.deck = dem_add_screen(&s.world, steel, &screen);
    if (s.deck != 0 || dem_add_cylinder(&s.world, steel, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), RADIUS, 1) < 0 ||
        dem_add_exit(&s.world, dem_vec3(0, 0, -0.03), dem_vec3(0, 0, 1)) < 0)
        return DEM_BAD_ARGUMENT;
    return dem_vibrate(&s.world, s.deck, dem_vec3(0, 0, s.now.amplitude), dem_vec3(0, 0, 0), s.now.frequency);
}

static dem_status fill(int glass) {
    dem_feed feed = dem_default_feed();
    dem_status status = DEM_OK;
    feed.region = dem_cylinder_region(dem_vec3(0, 0, 0.006), dem_vec3(0, 0, 1), 0.06, RADIUS);
    feed.material = glass, feed.tries = 5000;
    feed.velocity = dem_vec3(0, 0, -0.4), feed.scatter = dem_vec3(0.2, 0.2, 0.2);
    for (int k = CLASSES - 1; k >= 0 && status == DEM_OK; k--) { /* the large ones find room first */
        const ptrdiff_t before = feed.placed;
        feed.sizes = dem_one_size(s.now.diameter[k]), feed.group = k;
        status = dem_fill(&s.world, &feed, number[k]);
        s.fed[k] = s.left[k] = (int)(feed.placed - before);
    }
    return status;
}

static dem_status add_liquid(void) {
    double mass = 0.0;
    for (ptrdiff_t i = 0; i < s.world.count; i++) {
        s.group[s.world.id[i]] = s.world.group[i];
        s.sphere[s.world.id[i]] = 2.0 * s.world.particle[i].radius;
        mass += s.world.particle[i].mass;
    }
    s.world.user = &s.wet;
    return wet_init(&s.wet, (int)s.world.count, s.group, s.sphere, s.now.diameter, s.now.moisture, mass, s.deck,
                    &s.world, false, WET_STEEL) == BRIDGE_OK
               ? DEM_OK
               : DEM_BAD_DEFINITION;
}

static void take_sample(void) {
    if (s.samples == SAMPLES) { /* every other one goes, the rest is as far apart as a whole run needs */
        for (int n = 0; n < SAMPLES / 2; n++) {
            s.time[n] = s.time[2 * n + 1];
            for (int k = 0; k < CLASSES; k++) s.retained[k][n] = s.retained[k][2 * n + 1];
        }
        s.samples = SAMPLES / 2;
    }
    s.time[s.samples] = s.world.time;
    for (int k = 0; k < CLASSES; k++) s.retained[k][s.samples] = s.fed[k] ? (double)s.left[k] / s.fed[k] : 0.0;
    s.samples++;
}

/* A new batch; 0, or a dem_status. */
EXPORT(web_start)
int web_start(double amplitude, double frequency, double moisture, double aperture, double d0, double d1, double d2) {
    dem_free(&s.world);
    wet_free(&s.wet);
    memset(&s, 0, sizeof s);
    const settings now = {amplitude, frequency, moisture, aperture, {d0, d1, d2}};
    s.now = now;
    dem_def def = dem_default_def();
    const int glass = dem_add_material(&def, DENSITY, 5e10, 0.2), steel = dem_add_material(&def, 7850.0, 2e11, 0.3);
    for (int k = glass; k <= steel; k++) {
        dem_pair_def *p = dem_pair(&def, glass, k);
        p->stiffness = STIFFNESS, p->restitution = k == glass ? 0.78 : 0.44, p->friction = 0.3, p->rolling = 5e-5;
    }
    def.dt = DT;
    dem_status status = dem_init(&s.world, &def, NULL);
    if (status == DEM_OK) status = add_walls(steel);
    if (status == DEM_OK) status = fill(glass);
    if (status == DEM_OK) status = add_liquid();
    take_sample();
    return status;
}

/* The vibration changes where the deck passes its middle upwards, so that it stays where it is. */
static dem_status change_vibration(double amplitude, double frequency) {
    const double period = 1.0 / s.now.frequency, age = s.world.time - s.changed_at;
    const dem_status status = wet_run(&s.world, (floor(age / period) + 1.0) * period - age, 0);
    s.now.amplitude = amplitude, s.now.frequency = frequency;
    s.changed_at = s.world.time;
    return status != DEM_OK ? status
                            : dem_vibrate(&s.world, s.deck, dem_vec3(0, 0, amplitude), dem_vec3(0, 0, 0), frequency);
}

/* Runs so long [s]; 0, or a dem_status. */
EXPORT(web_run) int web_run(double duration, double amplitude, double frequency) {
    dem_status status = DEM_OK;
    if (amplitude != s.now.amplitude || frequency != s.now.frequency) status = change_vibration(amplitude, frequency);
    if (status == DEM_OK) status = wet_run(&s.world, duration, 0);
    for (ptrdiff_t k = 0; k < s.world.passed_count; k++) s.left[s.world.passed[k].group]--;
    dem_take_passed(&s.world, NULL, s.world.passed_count);
    if (s.world.time - s.time[s.samples - 1] >= SAMPLE) take_sample();
    return status;
}

/* ---- for the page to read ---- */

EXPORT(web_points) const float *web_points(void) {
    float *p = s.points;
    for (ptrdiff_t i = 0; i < s.world.count; i++) {
        if (!s.world.alive[i]) continue;
        const dem_vec x = dem_position(&s.world, i);
        *p++ = (float)x.x, *p++ = (float)x.y, *p++ = (float)x.z;
        *p++ = (float)s.world.particle[i].radius, *p++ = (float)s.world.group[i];
    }
    return s.points;
}
EXPORT(web_count) int web_count(void) {
    int n = 0;
    for (ptrdiff_t i = 0; i < s.world.count; i++) n += s.world.alive[i] != 0;
    return n;
}
EXPORT(web_deck) double web_deck(void) { return s.world.wall[s.deck].position.z; }
EXPORT(web_time) double web_time(void) { return s.world.time; }
EXPORT(web_bridges) int web_bridges(void) { return (int)dem_link_count(&s.world); }
EXPORT(web_samples) int web_samples(void) { return s.samples; }
EXPORT(web_sample_times) const double *web_sample_times(void) { return s.time; }
EXPORT(web_retained) const double *web_retained(int class) { return s.retained[class]; }

/* ---- models ---- */

/* Fits a model to the classes that can pass; its curve goes to twice the time so far. Number of classes, or minus a
   screen_status. */
EXPORT(web_fit) int web_fit(int model) {
    double time[FIT_POINTS], data[CLASSES * FIT_POINTS], curve[CLASSES * CURVE], sum = 0.0, shares[CLASSES];
    const int n = s.samples < FIT_POINTS ? s.samples : FIT_POINTS;
    int classes = 0;
    screen_def def = screen_default_def();
    while (classes < CLASSES && s.now.diameter[classes] < s.now.aperture) classes++;
    for (int k = 0; k < classes; k++)
        sum += shares[k] = s.fed[k] * s.now.diameter[k] * s.now.diameter[k] * s.now.diameter[k];
    for (int k = 0; k < classes; k++) shares[k] /= sum;
    def.aperture = s.now.aperture, def.wire = WIRE, def.classes = classes, def.diameters = s.now.diameter,
    def.shares = shares;
    def.density = DENSITY, def.duration = s.world.time > 0.0 ? s.world.time : 1.0;
    for (int k = 0; k < n; k++) {
        const int at = n > 1 ? k * (s.samples - 1) / (n - 1) : 0;
        time[k] = s.time[at];
        for (int c = 0; c < classes; c++) data[c * n + k] = s.retained[c][at];
    }
    const screen_operation operation = {s.now.amplitude, s.now.frequency, s.now.moisture, 0.0};
    const screen_case one = {operation, n, time, data};
    screen_fit_options options = screen_default_fit_options((screen_model)model);
    screen_fit_result result;
    options.starts = 4, options.iterations = 120;
    screen_status status = classes ? screen_fit(&def, (screen_model)model, 1, &one, &options, &result) : SCREEN_BAD_DEF;
    for (int k = 0; k < CURVE; k++) s.curve_time[k] = 2.0 * s.world.time * k / (CURVE - 1);
    if (status == SCREEN_OK)
        status = screen_predict(&def, (screen_model)model, result.parameter, &operation, CURVE, s.curve_time, curve,
                                NULL, NULL);
    for (int c = 0; c < classes; c++)
        for (int k = 0; k < CURVE; k++) s.curve[model][c][k] = status == SCREEN_OK ? curve[c * CURVE + k] : (double)NAN;
    s.deviation[model] = status == SCREEN_OK ? result.deviation : (double)NAN;
    return status == SCREEN_OK ? classes : -(int)status;
}
EXPORT(web_curve) const double *web_curve(int model, int class) { return s.curve[model][class]; }
EXPORT(web_curve_times) const double *web_curve_times(void) { return s.curve_time; }
EXPORT(web_deviation) double web_deviation(int model) { return s.deviation[model]; }

/* ---- the same bits ---- */

/* The default batch after 1000 steps. It ends the live one. */
EXPORT(web_check) uint64_t web_check(void) {
    if (web_start(1e-3, 25.0, 0.02, 6e-3, 3.5e-3, 5e-3, 8e-3) != DEM_OK) return 0;
    return wet_run(&s.world, 1000.0 * DT, 0) == DEM_OK && s.world.step == 1000 ? dem_hash(&s.world) : 0;
}
EXPORT(web_status_text) const char *web_status_text(int status) { return dem_status_text((dem_status)status); }
EXPORT(web_default_spheres) int web_default_spheres(void) { return s.fed[0] + s.fed[1] + s.fed[2]; }
EXPORT(web_wire) double web_wire(void) { return WIRE; }
EXPORT(web_radius) double web_radius(void) { return RADIUS; }
EXPORT(web_free) void web_free(void) {
    dem_free(&s.world);
    wet_free(&s.wet);
}
