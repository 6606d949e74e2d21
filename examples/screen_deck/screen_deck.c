/* screen_deck - a vibrating screen of your own under a steady feed, by dem.h.

   A section of the width of an inclined screen with one to three decks, square meshes or slots, and linear, circular or
   elliptic motion is fed with a size distribution, dry or moist, until outflow equals inflow. From then on the program
   measures the partition curve with 95 % intervals, efficiency, flows, bed depth and velocity along the deck, blocked
   holes by zone, and residence times. A second run has another feed rate. The process models of screen_models.h are
   fitted to the first run and predict the second; DEM and each model give the deck area that a recovery needs.

   deck_scene.h   the machine       deck_measure.h   measurements       deck_models.h   the models       deck_report.h
                                                     pictures, files */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "deck_report.h"

/* ---- one run ---- */

static bool is_over(const deck_run *r) {
    const int done = deck_windows_done(&r->books, &r->deck);
    return r->books.steady >= 0 ? done >= r->books.finish : r->deck.world.time >= r->def.longest - 0.5 * r->deck.step;
}

static int run_one(int index, void *user) {
    study *st = user;
    deck_run *r = &st->run[index];
    int windows = 0;
    riddle_io_series *series = index == 0 && st->frames ? riddle_io_series_open(st->self->out, "grains.pvd") : NULL;
    r->status = deck_make(&r->deck, &r->def);
    deck_books_open(&r->books, &r->def, st->window);
    while (r->status == DEM_OK && !is_over(r) && !common_interrupted()) {
        r->status = deck_advance(&r->deck);
        if (r->status == DEM_OK && deck_look(&r->books, &r->deck)) r->status = DEM_OUT_OF_MEMORY;
        const int done = deck_windows_done(&r->books, &r->deck);
        if (done == windows || r->status != DEM_OK) continue;
        progress_add(&st->bar, (done - windows) * st->window);
        windows = done;
        deck_find_steady(&r->books, done, st->tolerance, st->measure);
        if (series) write_frame(r, st->self->out, series);
    }
    riddle_io_series_close(series);
    if (r->status != DEM_OK || common_interrupted()) return 1;
    r->first = r->books.steady >= 0 ? r->books.steady : windows / 2;
    r->end = r->books.steady >= 0 ? r->books.finish : windows;
    for (int k = 0; k < r->def.decks; k++) deck_measure(&r->books, &r->def, k, r->first, r->end, &r->answer[k]);
    for (ptrdiff_t i = 0; i < r->deck.world.count; i++) {
        if (!r->deck.world.alive[i]) continue;
        r->present[r->books.grain[r->deck.world.id[i]].klass]++;
    }
    if (r->deck.wet) {
        int bridges;
        r->liquid_error = fabs(wet_total(r->deck.wet, &r->deck.world, &bridges) / r->deck.liquid - 1.0);
    }
    return 0;
}

/* The first run fitted, the second predicted with the first one's velocity of travel, as a plant would be. */
static void fit_models(study *st) {
    deck_run *fitted = &st->run[0];
    const double velocity = deck_travel(&fitted->answer[0]);
    for (int k = 0; k < st->runs; k++) {
        deck_run *r = &st->run[k];
        deck_take_curves(&r->answer[0], &r->books.classes, &r->def, velocity, &r->curves);
        r->length_by_dem = deck_length_by_dem(&r->curves, st->recovery);
    }
    for (int m = 0; m < DECK_MODELS; m++) {
        deck_fit_model(&fitted->curves, &fitted->def, (screen_model)m, st->load_exponent, st->self->seed, &st->fit[m]);
        for (int k = 0; k < st->runs; k++) {
            deck_run *r = &st->run[k];
            r->deviation[m] = deck_predict(&st->fit[m], &r->curves, &r->def, r->predicted[m]);
            r->length_by_model[m] = deck_length_by_model(&st->fit[m], &r->curves, &r->def, velocity, st->recovery);
            deck_duty_by_model(&st->fit[m], &r->curves, &r->def, velocity, st->recovery, &r->efficiency[m],
                               &r->capacity[m]);
        }
    }
}

/* ---- input ---- */

typedef struct input {
    /* t/h, m, mm, degrees */
    double feed, machine, section, inclination, amplitude, minor, direction, spacing, slot, rolling, drop;
    double rr_size, rr_exponent, smallest, largest;
    int motion, rotation;
    const char *apertures, *wires, *psd;
    bool no_frames, no_models, brief;
    double second;
} input;

/* "10,6.3" [mm] into values [m], each in 0.1 .. 500 mm; returns how many, or 0. */
static int read_list(const char *text, double *values) {
    int n = 0;
    if (text[strspn(text, "0123456789.,")] != '\0') return 0;
    while (n < DECKS_MAX) {
        char *end;
        const double v = strtod(text, &end);
        if (end == text || !(v >= 0.1 && v <= 500.0)) return 0;
        values[n++] = 1e-3 * v;
        if (*end == '\0') return n;
        if (*end != ',') return 0;
        text = end + 1;
    }
    return 0;
}

/* A sieve curve as a list of sizes, evenly spread in ln d. Returns the share below `smallest`. */
static double read_psd(const program *self, const char *path, double smallest, double largest, dem_sizes *sizes) {
    char message[600];
    sheet_sizes curve;
    if (sheet_read_sizes(path, NULL, 1, &curve, message, sizeof message)) program_refuse(self, "psd", path, message);
    if (curve.single || curve.n < 2)
        program_refuse(self, "psd", path, "a sieve curve of at least two sieves: the column passing or retained");
    common_print("%s\n", curve.how);
    double passed[DEM_SIZES_MAX + 1], diameter[DEM_SIZES_MAX], share[DEM_SIZES_MAX];
    const double *size = curve.size, *passing = curve.amount[0];
    for (int k = 0; k <= DEM_SIZES_MAX; k++) {
        const double d = smallest * pow(largest / smallest, (double)k / DEM_SIZES_MAX);
        int q = 0;
        while (q < curve.n && size[q] < d) q++;
        passed[k] = q == 0         ? 0.0
                    : q == curve.n ? passing[q - 1]
                                   : passing[q - 1] + (passing[q] - passing[q - 1]) * log(d / size[q - 1]) /
                                                          log(size[q] / size[q - 1]);
        if (k == 0 && q == 0) passed[k] = passing[0];
    }
    for (int k = 0; k < DEM_SIZES_MAX; k++) {
        diameter[k] = smallest * pow(largest / smallest, (k + 0.5) / DEM_SIZES_MAX),
        share[k] = fmax(passed[k + 1] - passed[k], 0.0);
    }
    sheet_free_sizes(&curve);
    if (!(passed[DEM_SIZES_MAX] - passed[0] > 0.0))
        program_refuse(self, "psd", path, "a curve with grains between --smallest-mm and --largest-mm");
    *sizes = dem_size_list(DEM_SIZES_MAX, diameter, share, 1);
    return passed[0];
}

/* What --quick and --short leave of the machine where nothing else is asked for: a shorter deck, less of its width,
   shorter windows. */
static void shorten(study *st, deck_def *d, input *in, bool quick, bool own_length, bool own_section, bool own_feed) {
    if (!own_length) d->length = quick ? 0.3 : 0.8;
    if (!own_section) in->section = quick ? 60.0 : 75.0;
    if (!own_feed) in->feed = quick ? 20.0 : 60.0;
    st->window = quick ? 0.2 : 0.25;
    st->measure = quick ? 2.0 : 4.0;
    st->tolerance = quick ? 0.25 : 0.1;
    d->longest = quick ? 10.0 : 20.0;
}

/* The stiffness at which the largest grain that falls onto a deck presses into it by a third of a wire [N/m], the most
   of all decks. */
static double stiffness_for(const deck_def *d) {
    const double shake = 2.0 * RIDDLE_PI * d->frequency * fmax(d->amplitude, fabs(d->minor));
    double stiffness = 0.0;
    for (int k = 0; k < d->decks; k++) {
        const double size = k ? fmin(d->aperture[k - 1], deck_largest(&d->sizes)) : deck_largest(&d->sizes);
        const double speed = sqrt(2.0 * 9.81 * (k ? d->spacing : d->drop)) + shake, third = d->wire[k] / 3.0;
        stiffness =
            fmax(stiffness, d->density * RIDDLE_PI / 6.0 * size * size * size * speed * speed / (third * third));
    }
    return stiffness;
}

/* Takes it for the default; soft grains, that press by more than half a wire, are refused. */
static void choose_stiffness(const program *self, deck_def *d, bool given) {
    const double stiffness = stiffness_for(d);
    char allowed[120];
    snprintf(allowed, sizeof allowed, "at least %.3g N/m, or the largest grains press through the wires",
             stiffness * 4.0 / 9.0);
    if (!given) d->stiffness = stiffness;
    else if (!(d->stiffness >= stiffness * 4.0 / 9.0)) program_refuse(self, "stiffness", NULL, allowed);
}

/* Threads of a run: those left when each run has one, if there may be many grains to share; of few they wait more
   than they work. */
static int threads_for(const deck_def *d, const program *self, int runs) {
    uint64_t random = 1;
    double volume = 0.0;
    for (int k = 0; k < 1000; k++) volume += 1e-3 * RIDDLE_PI / 6.0 * pow(dem_draw_size(&d->sizes, &random), 3.0);
    const double travel = 0.3, grains = d->flow * d->length / travel / (d->density * volume);
    return self->threads > runs && grains > 20000.0 ? self->threads / runs : 1;
}

/* The definition from what was asked for; refuses what cannot be. */
static void define(const program *self, const input *in, deck_def *d, double *left_out) {
    const double degrees = RIDDLE_PI / 180.0;
    d->decks = read_list(in->apertures, d->aperture);
    if (d->decks == 0)
        program_refuse(self, "aperture-mm", in->apertures, "one to three numbers from 0.1 to 500, as 10,6.3,4");
    if (in->wires && read_list(in->wires, d->wire) != d->decks)
        program_refuse(self, "wire-mm", in->wires, "as many numbers from 0.1 to 500 as apertures");
    for (int k = 0; k < d->decks && !in->wires; k++) d->wire[k] = 0.25 * d->aperture[k];
    if (!(in->smallest < in->largest)) program_refuse(self, "smallest-mm", NULL, "less than --largest-mm");
    if (in->psd) *left_out = read_psd(self, in->psd, 1e-3 * in->smallest, 1e-3 * in->largest, &d->sizes);
    else {
        d->sizes =
            dem_rosin_rammler_sizes(1e-3 * in->rr_size, in->rr_exponent, 1e-3 * in->smallest, 1e-3 * in->largest, 1);
        *left_out = 1.0 - exp(-pow(in->smallest / in->rr_size, in->rr_exponent));
    }
    d->slot_length = 1e-3 * in->slot, d->width = 1e-3 * in->section, d->spacing = 1e-3 * in->spacing;
    d->inclination = in->inclination * degrees, d->direction = in->direction * degrees;
    d->amplitude = 1e-3 * in->amplitude, d->minor = in->motion == 0   ? 0.0
                                                    : in->motion == 1 ? d->amplitude
                                                                      : 1e-3 * in->minor;
    if (in->rotation) d->minor = -d->minor;
    d->rolling = 1e-3 * in->rolling, d->drop = 1e-3 * in->drop;
    const char *bad = deck_round(d);
    if (bad && strcmp(bad, "aperture") == 0)
        program_refuse(self, "aperture-mm", in->apertures, "falling from deck to deck");
    if (bad && strcmp(bad, "length") == 0)
        program_refuse(self, "length-m", NULL, "longer than the feed's place and two of the largest grains");
    if (bad && strcmp(bad, "width") == 0) program_refuse(self, "section-mm", NULL, "less than 2000 pitches");
    if (bad && strcmp(bad, "spacing") == 0)
        program_refuse(self, "spacing-mm", NULL, "more than two of the largest grains and four amplitudes");
    if (bad) program_refuse(self, bad, NULL, "another value");
    uint64_t random = 1;
    if (!(dem_draw_size(&d->sizes, &random) > 0.0))
        program_refuse(self, "rr-exponent", NULL, "0.1 .. 100, with grains between --smallest-mm and --largest-mm");
    d->flow = in->feed / 3.6 * d->width / in->machine;
}

static void simulate(study *st, const deck_def *d, double second) {
    for (int k = 0; k < st->runs; k++) {
        st->run[k].def = *d;
        if (k) st->run[k].def.flow *= second, st->run[k].def.seed += 7919u;
    }
    progress_begin(&st->bar, "screening", st->runs * d->longest);
    jobs_run(st->runs, st->self->threads, run_one, st);
    progress_end(&st->bar);
    for (int k = 0; k < st->runs && !common_interrupted(); k++)
        if (st->run[k].status != DEM_OK)
            common_fail("feed %.4g kg/s: %s (grain %llu)", st->run[k].def.flow, dem_status_text(st->run[k].status),
                        (unsigned long long)st->run[k].deck.world.failed_id);
}

int main(int argc, char **argv) {
    static study st;
    deck_def def = deck_default(), *d = &def;
    input in = {.feed = 110.0,
                .machine = 1.2,
                .section = 300.0,
                .inclination = 12.0,
                .amplitude = 4.0,
                .minor = 2.0,
                .direction = 45.0,
                .spacing = 150.0,
                .slot = 0.0,
                .rolling = 0.3,
                .drop = 100.0,
                .rr_size = 11.0,
                .rr_exponent = 2.2,
                .smallest = 4.0,
                .largest = 20.0,
                .apertures = "10",
                .second = 0.6};
    d->length = 1.2;
    st.window = 0.5, st.measure = 4.0, st.tolerance = 0.05, st.recovery = 0.9;
    option options[] = {
        option_positive("feed-t-h", "T/H", &in.feed, 1e5, "feed of the whole machine [t/h]"),
        option_positive("section-mm", "MM", &in.section, 1e4,
                        "simulated section of the width, rounded to whole pitches [mm]"),
        option_positive("length-m", "M", &d->length, 100.0, "length of a deck, rounded to whole pitches [m]"),
        option_positive("longest-s", "S", &d->longest, 1e4,
                        "simulated time within which a steady state must be found [s]"),
        option_double("window-s", "S", &st.window, 0.02, 100.0,
                      "of means in time; eight of them in balance are steady [s]"),
        option_positive("measure-s", "S", &st.measure, 1e4,
                        "measured time from the steady state on, at least eight windows [s]"),
        option_double("tolerance", "X", &st.tolerance, 0.001, 1.0,
                      "share of the feed to which in and out agree for certain when steady [-]"),
        option_positive("stiffness", "N/M", &d->stiffness, 1e9,
                        "of contacts; default: the largest falling grain presses into a wire by a third of it [N/m]"),
        option_positive("machine-width-m", "M", &in.machine, 20.0, "width of the whole machine [m]"),
        option_double("second-feed", "X", &in.second, 0.0, 5.0,
                      "feed of the second run over that of the first; 0: none [-]"),
        option_string("aperture-mm", "A,...", &in.apertures,
                      "clear width of holes, a number for each deck from the top, one to three [mm]"),
        option_string("wire-mm", "W,...", &in.wires,
                      "diameter of wires, width of slots' bars [mm]; default: a quarter of the aperture"),
        option_choice("holes", &d->mesh, "square|slots-along|slots-across",
                      "woven mesh, or flat bars along or across the flow"),
        option_double("slot-length-mm", "MM", &in.slot, 0.0, 1e4,
                      "clear length of slots between cross bars; 0: no cross bars [mm]"),
        option_positive("spacing-mm", "MM", &in.spacing, 1e4, "distance of the decks [mm]"),
        option_double("inclination-deg", "DEG", &in.inclination, 0.0, 45.0, "of the decks, downhill [degrees]"),
        option_choice("motion", &in.motion, "linear|circular|elliptic", "of the deck"),
        option_double("amplitude-mm", "MM", &in.amplitude, 0.0, 100.0,
                      "half the stroke; half the long axis of an ellipse [mm]"),
        option_double("minor-mm", "MM", &in.minor, 0.0, 100.0, "half the short axis of an ellipse [mm]"),
        option_double("direction-deg", "DEG", &in.direction, 0.0, 180.0,
                      "of the line or the long axis against the deck [degrees]"),
        option_choice("rotation", &in.rotation, "with|against",
                      "circle, ellipse: at its top the deck runs with the flow, or against it"),
        option_positive("frequency-hz", "HZ", &d->frequency, 200.0, "[Hz]"),
        option_string("psd", "FILE", &in.psd,
                      "sieve curve of the feed: CSV with size_mm,passing (share finer, 0 .. 1)"),
        option_positive("rr-size-mm", "MM", &in.rr_size, 1e3,
                        "without --psd: size that 36.8 % of the feed exceed (Rosin-Rammler) [mm]"),
        option_double("rr-exponent", "N", &in.rr_exponent, 0.1, 100.0, "without --psd: exponent of Rosin-Rammler [-]"),
        option_positive("smallest-mm", "MM", &in.smallest, 1e3,
                        "finer grains are left out: they pass at once and cost most [mm]"),
        option_positive("largest-mm", "MM", &in.largest, 1e3, "coarser grains are left out [mm]"),
        option_double("moisture", "SHARE", &d->moisture, 0.0, 0.08, "mass of water over mass of grains [-]"),
        option_positive("density", "KG/M3", &d->density, 3e4, "of the grains [kg/m3]"),
        option_double("friction", "MU", &d->friction, 0.0, 10.0, "coefficient of friction, grains and deck [-]"),
        option_double("restitution", "E", &d->restitution, 0.05, 1.0, "coefficient of restitution [-]"),
        option_double("rolling-mm", "MM", &in.rolling, 0.0, 100.0, "lever arm of rolling resistance [mm]"),
        option_positive("drop-mm", "MM", &in.drop, 5e3, "height from which the feed falls [mm]"),
        option_double("recovery", "X", &st.recovery, 0.01, 0.999,
                      "share of the undersize for which deck areas are compared [-]"),
        option_double("load-exponent", "N", &st.load_exponent, 0.0, 10.0,
                      "models 0, 1, 2: passage goes with one over the load to this power; 0: they do not know it [-]"),
        option_flag("short", &in.brief, "under a minute: a deck of 0.8 m, 75 mm of its width, 60 t/h"),
        option_flag("no-frames", &in.no_frames, "no .vtp series"),
        option_flag("no-models", &in.no_models, "no process models"),
    };
    program self = program_start(
        "screen_deck", "A vibrating screen under a steady feed, for one's own machine: partition, bed, blocking.",
        options, sizeof options / sizeof *options, argc, argv);
    const double window = st.window, measure = st.measure, tolerance = st.tolerance, longest = d->longest;
    if (in.brief || self.quick)
        shorten(&st, d, &in, self.quick, is_given(&self, "length-m"), is_given(&self, "section-mm"),
                is_given(&self, "feed-t-h"));
    if (is_given(&self, "window-s")) st.window = window;
    if (is_given(&self, "measure-s")) st.measure = measure;
    if (is_given(&self, "tolerance")) st.tolerance = tolerance;
    if (is_given(&self, "longest-s")) d->longest = longest;
    d->seed = self.seed;
    define(&self, &in, d, &st.left_out);
    choose_stiffness(&self, d, is_given(&self, "stiffness"));
    st.self = &self;
    st.machine_width = in.machine;
    st.frames = !in.no_frames;
    st.runs = in.second > 0.0 ? 2 : 1;
    d->threads = threads_for(d, &self, st.runs);
    simulate(&st, d, in.second);
    if (common_exit_status() == 0) {
        st.models = in.no_models ? 0 : DECK_MODELS;
        if (st.models) fit_models(&st);
        report(&st);
    }
    for (int k = 0; k < st.runs; k++) deck_free(&st.run[k].deck), deck_books_free(&st.run[k].books);
    return common_exit_status();
}
