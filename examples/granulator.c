/* High-shear granulation by granulation.h: the studies of Gantt & Gatzke, High-shear granulation modeling using a
   discrete element simulation approach ("the paper"), each as an ensemble of replicates, beside a population balance.

   pouw      Table 1: solid, liquid and air by size class in time (figure 5), beside a population balance with the same
             laws and with Pouw's saturation kernel; a normal start (figures 6 and 7)
   impeller  Table 2 and figure 8: 120, 360, 720 and 840 rpm
   binder    Table 3 and figure 9: 15, 25, 33 and 40 % binder
   map       figure 10: every collision of some runs in the plane of the Stokes numbers, and the coalescence boundaries
             of the population as it then is
   midbatch  binder is sprayed on, the impeller slows down and the binder cools while a batch runs
   sound     Tables 2 and 3 with readings that conserve momentum: swept contacts
   custom    one condition of your own: --rpm, --binder, --viscosity ...

   The paper leaves about ten parameters and rules open. The set used here ("G1", granulation_paper_def) is a fit:
   docs/granulation.md. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "granulation.h"

enum { CLASSES = 10, MOST_STEPS = 2000, MOST_REPLICATES = 1000, GRID = 41, SPEEDS = 64 };

/* ---- one condition, many replicates ---- */

typedef struct condition {
    double rpm, liquid; /* [1/min], volume fraction [-] */
    bool normal_feed;   /* volumes N(3, 1) e-12 m3 instead of Table 1 */
    int granules;
    granulation_def def;
} condition;

/* A change in mid-batch; step < 0: none */
typedef struct change {
    int spray_step, impeller_step, cool_step;
    double liquid, rpm, temperature; /* [m3 per m3 of granules], [1/min], [K] */
} change;

/* What a replicate leaves, by step 0 .. steps */
typedef struct record {
    granulation_replicate result;
    granulation_status status;
    double *q;              /* [4][steps+1][CLASSES]: count, solid, liquid, air */
    double *size, *number;  /* [steps+1] d43 [m], granules */
    double *film, *success; /* [steps+1] mean film [m], share of the step's interactions that coalesced */
    unsigned outside;       /* flags of what was outside the fit at the start or at the end */
} record;

typedef struct ensemble {
    const condition *c;
    const change *change;
    const double *edges; /* [CLASSES+1] [m3] */
    int steps, replicates;
    uint64_t seed;
    record *records;
    double *memory;
    progress *bar;
} ensemble;

static double speed_of(double rpm) {
    return granulation_tip_speed(GRANULATION_PRINTED, rpm / 60.0, 1.0);
} /* (33) as the paper uses it, 1 m */

/* Swept contacts at the sum of the radii, momentum conserved, two velocities of three drawn anew each step (the
   impeller acts all the time), half of the granules moving against the other half. Four numbers refitted to the same 12
   percentages and 6 sizes. */
static granulation_def sound_def(void) {
    granulation_def def = granulation_default_def();
    def.stirring = 1.0;
    def.signs = GRANULATION_TWO_STREAMS;
    def.laws.viscosity = 0.0496;
    def.laws.yield_ratio = 0.0366;
    def.laws.limit_diameter = 2.26e-4;
    def.dilation = 1.03e5;
    return def;
}

/* Returns what lies outside the fit. The sound readings have a fit of their own, to the same tables. */
static unsigned outside_of(const granulation_sim *sim) {
    const granulation_def sound = sound_def(), paper = granulation_paper_def();
    granulation_sim fitted = *sim;
    granulation_def *d = &fitted.def;
    if (d->stirring == sound.stirring && d->signs == sound.signs && d->dilation == sound.dilation &&
        d->laws.viscosity == sound.laws.viscosity && d->laws.yield_ratio == sound.laws.yield_ratio &&
        d->laws.limit_diameter == sound.laws.limit_diameter && d->detection == sound.detection &&
        d->contact == sound.contact && d->bounce == sound.bounce && d->approaching_only == sound.approaching_only) {
        d->stirring = paper.stirring, d->signs = paper.signs, d->dilation = paper.dilation;
        d->laws.viscosity = paper.laws.viscosity, d->laws.yield_ratio = paper.laws.yield_ratio;
        d->laws.limit_diameter = paper.laws.limit_diameter, d->detection = paper.detection, d->contact = paper.contact;
        d->bounce = paper.bounce, d->approaching_only = paper.approaching_only;
    }
    return granulation_sim_outside(&fitted);
}

static condition condition_of(granulation_def def, double rpm, double liquid) {
    condition c = {rpm, liquid, false, 192, def};
    for (int k = 0; k < 3; k++) c.def.velocity_mean[k] = speed_of(rpm);
    return c;
}

/* Table 1, over again for more than 192 granules */
static double table1_volume(int i) {
    int k = i % 192;
    return k < 120 ? 2e-12 : k < 162 ? 4e-12 : k < 182 ? 6e-12 : k < 187 ? 8e-12 : 10e-12;
}

static granulation_granule granule_of(double volume, double liquid) {
    granulation_granule g = {volume * (0.85 - liquid), volume * liquid, volume * 0.15};
    return g;
}

static granulation_status start(granulation_sim *sim, const condition *c, uint64_t seed) {
    granulation_def def = c->def;
    def.seed = seed;
    def.box = 2e-3 * cbrt(c->granules / 192.0);
    granulation_status status = granulation_sim_init(sim, &def);
    granulation_random random = granulation_random_seed(seed ^ 0x5eed);
    for (int i = 0; i < c->granules && status == GRANULATION_OK; i++) {
        double volume = table1_volume(i);
        if (c->normal_feed) do
                volume = 3e-12 + 1e-12 * granulation_random_normal(&random);
            while (!(volume > 0.2e-12));
        granulation_granule g = granule_of(volume, c->liquid);
        int same = 1;
        while (!c->normal_feed && i + same < c->granules && table1_volume(i + same) == volume) same++;
        status = granulation_sim_add(sim, &g, same);
        i += same - 1;
    }
    return status;
}

static granulation_status apply(granulation_sim *sim, const change *what, int step) {
    granulation_status status = GRANULATION_OK;
    if (step == what->spray_step) {
        granulation_granule all;
        granulation_sim_totals(sim, &all, NULL, NULL);
        status = granulation_sim_spray(sim, what->liquid * granulation_volume(&all), 0.0);
    }
    if (status == GRANULATION_OK && step == what->impeller_step) {
        double mean = speed_of(what->rpm), three[3] = {mean, mean, mean};
        status = granulation_sim_impeller(sim, three, sim->def.velocity_deviation, true);
    }
    if (status == GRANULATION_OK && step == what->cool_step) {
        granulation_def def = sim->def;
        def.laws.viscosity = granulation_arrhenius(def.laws.viscosity, 5000.0, what->temperature, 298.15);
        status = granulation_sim_set(sim, &def);
    }
    return status;
}

/* Classes by the volume that a granule would have with the air of the feed: consolidation then moves nobody to
   another class. */
static double volume_at_start(double wet) { return wet / 0.85; }

static void note(const granulation_sim *sim, const ensemble *e, record *r, int step, const granulation_tally *before) {
    size_t row = (size_t)step * CLASSES, block = (size_t)(e->steps + 1) * CLASSES;
    for (int i = 0; i < sim->n; i++) {
        const granulation_granule *g = &sim->body[i].volumes;
        double volume = volume_at_start(g->s + g->l);
        size_t k = 0;
        while (k < CLASSES - 1 && volume >= e->edges[k + 1]) k++;
        r->q[row + k] += 1.0;
        r->q[block + row + k] += g->s;
        r->q[2 * block + row + k] += g->l;
        r->q[3 * block + row + k] += g->a;
    }
    r->size[step] = granulation_sim_mean(sim, 4, 3);
    r->number[step] = sim->n;
    double film = 0.0, held = 0.0, met = (double)(sim->tally.interactions - before->interactions);
    for (int i = 0; i < sim->n; i++) film += sim->body[i].film / sim->n;
    for (int k = GRANULATION_TYPE_I; k <= GRANULATION_TYPE_II_DRY; k++)
        held += (double)(sim->tally.by_reason[k] - before->by_reason[k]);
    r->film[step] = film;
    r->success[step] = met > 0.0 ? held / met : 0.0;
}

static int one_replicate(int index, void *user) {
    ensemble *e = (ensemble *)user;
    record *r = e->records + index;
    granulation_sim sim;
    r->status = start(&sim, e->c, program_seed_of(e->seed, (uint64_t)index));
    granulation_tally before = sim.tally;
    if (r->status == GRANULATION_OK) note(&sim, e, r, 0, &before), r->outside = outside_of(&sim);
    for (int step = 0; step < e->steps && r->status == GRANULATION_OK; step++) {
        if (e->change) r->status = apply(&sim, e->change, step);
        before = sim.tally;
        if (r->status == GRANULATION_OK) r->status = granulation_sim_run(&sim, 1);
        if (r->status == GRANULATION_OK) note(&sim, e, r, step + 1, &before);
    }
    r->result = granulation_replicate_of(&sim);
    if (r->status == GRANULATION_OK) r->outside |= outside_of(&sim);
    granulation_sim_free(&sim);
    if (e->bar) progress_add(e->bar, 1.0);
    return r->status != GRANULATION_OK;
}

/* Runs all replicates; 0, or -1 after one line on stderr. Free with ensemble_free. */
static int ensemble_run(ensemble *e, const program *self) {
    size_t block = (size_t)(e->steps + 1) * CLASSES, series = (size_t)(e->steps + 1), each = 4 * block + 4 * series;
    e->records = (record *)calloc((size_t)e->replicates, sizeof *e->records);
    e->memory = (double *)calloc((size_t)e->replicates * each, sizeof *e->memory);
    if (!e->records || !e->memory) return common_fail("out of memory");
    for (int i = 0; i < e->replicates; i++) {
        double *own = e->memory + (size_t)i * each;
        record r = {.q = own,
                    .size = own + 4 * block,
                    .number = own + 4 * block + series,
                    .film = own + 4 * block + 2 * series,
                    .success = own + 4 * block + 3 * series};
        e->records[i] = r;
    }
    int failed = jobs_run(e->replicates, self->threads, one_replicate, e);
    if (common_interrupted()) return -1;
    for (int i = 0; i < e->replicates && failed; i++)
        if (e->records[i].status != GRANULATION_OK)
            return common_fail("%g rpm, binder %g, replicate %d: %s", e->c->rpm, e->c->liquid, i,
                               granulation_status_text(e->records[i].status));
    return 0;
}

static void ensemble_free(ensemble *e) {
    free(e->records);
    free(e->memory);
    e->records = NULL;
    e->memory = NULL;
}

/* field k of granulation_replicate over the replicates */
static granulation_estimate result_of(const ensemble *e, int k) {
    double values[MOST_REPLICATES][GRANULATION_REPLICATE_FIELDS];
    for (int i = 0; i < e->replicates; i++) memcpy(values[i], &e->records[i].result, sizeof values[i]);
    return granulation_estimate_of(&values[0][k], e->replicates, GRANULATION_REPLICATE_FIELDS);
}

/* The flags of what lies outside the fit in most replicates, and in words; "" for nothing. */
static unsigned outside_in_most(const ensemble *e) {
    unsigned flags = 0;
    for (unsigned flag = 1; flag <= GRANULATION_OUTSIDE_RULES; flag *= 2) {
        int n = 0;
        for (int i = 0; i < e->replicates; i++) n += (e->records[i].outside & flag) != 0;
        if (2 * n > e->replicates) flags |= flag;
    }
    return flags;
}
static const char *outside_text(char *words, size_t size, unsigned flags) {
    *words = '\0';
    for (unsigned flag = 1; flag <= GRANULATION_OUTSIDE_RULES; flag *= 2) {
        const size_t used = strlen(words);
        if (flags & flag) snprintf(words + used, size - used, "%s%s", used ? "; " : "", granulation_outside_text(flag));
    }
    return words;
}
/* Says after a table what lies outside the fit in one of its rows. */
static void say_outside(const char *name, unsigned flags) {
    char words[500];
    if (flags) common_print("%s: an extrapolation; %s.\n", name, outside_text(words, sizeof words, flags));
}

/* mean and confidence of one number of each record: base of the first, the others at the same offset */
static granulation_estimate over(const ensemble *e, const double *first) {
    size_t each = 4 * (size_t)(e->steps + 1) * CLASSES + 4 * (size_t)(e->steps + 1);
    return granulation_estimate_of(first, e->replicates, (int)each);
}

/* ---- rows: Tables 2 and 3 ---- */

typedef struct paper_row {
    double rpm, liquid, type1, type2, rebound, size_um; /* NaN: not in our copy */
} paper_row;

static const paper_row paper_rows[7] = {
    {120, .33, 6.1, 3.2, 90.7, 219.6},
    {360, .33, 5.9, 7.5, 86.6, 233.5},
    {720, .33, 5.0, 8.4, 86.6, 237.5},
    {840, .33, 4.5, 11.0, 84.5, 229.3},
    {360, .15, 1.6, 3.4, 95.0, 199.9},
    {360, .25, 3.9, 5.4, 90.7, 222.9},
    {360, .40, (double)NAN, (double)NAN, (double)NAN, (double)NAN},
};

static const paper_row *paper_for(double rpm, double liquid) {
    for (int i = 0; i < 7; i++)
        if (paper_rows[i].rpm == rpm && fabs(paper_rows[i].liquid - liquid) < 1e-9) return paper_rows + i;
    return NULL;
}

static void write_row(json *report, const char *study, const ensemble *e) {
    static const char *const keys[GRANULATION_REPLICATE_FIELDS] = {
        "type1_pct", "type2_pct", "rebound_pct", "both_pct", "mean_size_m", "interactions", "breakages", "granules",
        "d10_m",     "d30_m",     "d32_m",       "x10_m",    "x50_m",       "x90_m",        "span"};
    char key[40], words[500];
    json_object_begin(report, NULL);
    json_string(report, "study", study);
    results_values(report, {"rpm", e->c->rpm}, {"binder", e->c->liquid}, {"replicates", e->replicates},
                   {"outside_flags", outside_in_most(e)});
    json_string(report, "outside", outside_text(words, sizeof words, outside_in_most(e)));
    for (int k = 0; k < GRANULATION_REPLICATE_FIELDS; k++) {
        granulation_estimate x = result_of(e, k);
        json_number(report, keys[k], x.mean);
        snprintf(key, sizeof key, "%s_sd", keys[k]);
        json_number(report, key, x.deviation);
        snprintf(key, sizeof key, "%s_ci95", keys[k]);
        json_number(report, key, x.confidence);
    }
    json_object_end(report);
}

static const result_column row_columns[] = {{"rpm", "rpm", "%g"},
                                            {"binder", "binder [%]", "%g", 100.0},
                                            {"type1_pct", "Type I [%]", "%.1f"},
                                            {"type1_ci95", "+- 95 %", "%.1f"},
                                            {"type2_pct", "Type II [%]", "%.1f"},
                                            {"type2_ci95", "+- 95 %", "%.1f"},
                                            {"rebound_pct", "rebound [%]", "%.1f"},
                                            {"rebound_ci95"},
                                            {"both_pct"},
                                            {"both_ci95"},
                                            {"d43_m", "d43 [um]", "%.1f", 1e6},
                                            {"d43_ci95", "+- 95 %", "%.1f", 1e6},
                                            {"interactions", "interactions", "%.0f"},
                                            {"interactions_ci95"},
                                            {NULL, "breakages", "%.2f"},
                                            {"paper_type1_pct", "paper: I", "%.1f"},
                                            {"paper_type2_pct", "II", "%.1f"},
                                            {"paper_rebound_pct", "rebound", "%.1f"},
                                            {"paper_d43_m", "d43 [um]", "%.1f", 1e6}};

static void add_row(result_table *t, const ensemble *e) {
    static const paper_row nothing = {NAN, NAN, NAN, NAN, NAN, NAN};
    const paper_row *p = paper_for(e->c->rpm, e->c->liquid) ? paper_for(e->c->rpm, e->c->liquid) : &nothing;
    granulation_estimate x[7];
    for (int k = 0; k < 7; k++) x[k] = result_of(e, k);
    results_row(t, NULL, e->c->rpm, e->c->liquid, x[0].mean, x[0].confidence, x[1].mean, x[1].confidence, x[2].mean,
                x[2].confidence, x[3].mean, x[3].confidence, x[4].mean, x[4].confidence, x[5].mean, x[5].confidence,
                x[6].mean, p->type1, p->type2, p->rebound, 1e-6 * p->size_um);
}

/* volumes of 1e-12 m3 a class, the last one open */
static void ten_classes(double edges[CLASSES + 1]) {
    for (int k = 0; k < CLASSES; k++) edges[k] = 1e-12 * k;
    edges[CLASSES] = 1e-6;
}
/* Table 1: around 2, 4 .. 10e-12 m3, then three more and an open one */
static void table1_classes(double edges[CLASSES + 1]) {
    edges[0] = 0.0;
    for (int k = 1; k < CLASSES; k++) edges[k] = 1e-12 * (2 * k + 1);
    edges[CLASSES] = 1e-6;
}

/* ---- impeller and binder: four conditions ---- */

static int study_rows(const program *self, json *report, const char *name, const condition *conditions, int n,
                      int replicates, int steps) {
    bool impeller = !strcmp(name, "impeller");
    double edges[CLASSES + 1];
    unsigned outside[4] = {0};
    char titles[4][60];
    table1_classes(edges);
    result_table *t = RESULTS(row_columns);
    riddle_plot *figure = riddle_plot_new(impeller ? "Gantt & Gatzke, Fig 8: size distribution at four impeller speeds"
                                                   : "Gantt & Gatzke, Fig 9: size distribution at four binder contents",
                                          2, 2);
    progress bar;
    progress_begin(&bar, impeller ? "impeller speeds" : "binder contents", (double)n * replicates);
    int bad = 0;
    for (int i = 0; i < n && !bad; i++) {
        ensemble e = {.c = conditions + i,
                      .edges = edges,
                      .steps = steps,
                      .replicates = replicates,
                      .seed = self->seed,
                      .bar = &bar};
        bad = ensemble_run(&e, self);
        if (!bad) {
            add_row(t, &e);
            write_row(report, name, &e);
            outside[i] = outside_in_most(&e);
            snprintf(titles[i], sizeof titles[i], impeller ? "%g rpm%s" : "%g %% binder%s",
                     impeller ? e.c->rpm : 100.0 * e.c->liquid, outside[i] ? " (outside the fit)" : "");
            riddle_plot_panel(figure, i / 2, i % 2, "volume at the feed's air content [10⁻¹² m³]",
                              "share of the solid volume [-]");
            riddle_plot_title(figure, titles[i]);
            for (int k = 0; k < 4; k++) {
                int step = k == 3 ? steps : k * steps / 4;
                double x[CLASSES], y[CLASSES], all = 0.0;
                size_t block = (size_t)(steps + 1) * CLASSES;
                for (int c = 0; c < CLASSES; c++)
                    all += y[c] = over(&e, e.records[0].q + block + (size_t)step * CLASSES + c).mean;
                for (int c = 0; c < CLASSES; c++) {
                    x[c] = 2.0 * (c + 1);
                    y[c] /= all > 0.0 ? all : 1.0;
                }
                char label[30];
                snprintf(label, sizeof label, "step %d", step);
                riddle_plot_line(figure, label, x, y, CLASSES);
                riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
            }
        }
        ensemble_free(&e);
    }
    progress_end(&bar);
    results_print(t);
    if (bad) {
        riddle_plot_free(figure);
        results_free(t);
        return bad;
    }
    results_csv(t, self->out, impeller ? "table2.csv" : "table3.csv");
    for (int i = 0; i < n; i++) say_outside(titles[i], outside[i]);
    riddle_plot_write(figure, self->out, impeller ? "figure8.svg" : "figure9.svg");
    figure = riddle_plot_new(impeller ? "Gantt & Gatzke, Table 2: what becomes of collisions"
                                      : "Gantt & Gatzke, Table 3: what becomes of collisions",
                             1, 3);
    static const char *const y_labels[3] = {"Type I coalescence [% of collisions]",
                                            "Type II coalescence [% of collisions]", "mean size d43 [µm]"};
    static const char *const keys[3][3] = {{"type1_pct", "type1_ci95", "paper_type1_pct"},
                                           {"type2_pct", "type2_ci95", "paper_type2_pct"},
                                           {"d43_m", "d43_ci95", "paper_d43_m"}};
    const double *at = results_column(t, impeller ? "rpm" : "binder", impeller ? 1.0 : 100.0);
    for (int q = 0; q < 3; q++) {
        riddle_plot_panel(figure, 0, q, impeller ? "impeller speed [1/min]" : "binder [%]", y_labels[q]);
        const double unit = q < 2 ? 1.0 : 1e6, *mean = results_column(t, keys[q][0], unit);
        double beyond_at[4], beyond[4];
        int beyonds = 0;
        for (int i = 0; i < n; i++)
            if (outside[i]) beyond_at[beyonds] = at[i], beyond[beyonds++] = mean[i];
        riddle_plot_error_bars(figure, "granulation.h, 95 %", at, mean, results_column(t, keys[q][1], unit), n);
        riddle_plot_points(figure, "paper", at, results_column(t, keys[q][2], unit), n);
        if (beyonds > 0) riddle_plot_points(figure, "outside the fit", beyond_at, beyond, beyonds);
    }
    results_free(t);
    return (int)riddle_plot_write(figure, self->out, impeller ? "table2.svg" : "table3.svg");
}

/* ---- pouw: the discrete simulation beside population balances ---- */

/* Coalescence in the paper's discrete simulation as a kernel: how often the rule for contacts finds a pair (one
   granule's centre within the larger radius at the end of a step), times the share of relative speeds at which the laws
   say coalescence. */
typedef struct found_pairs {
    const granulation_laws *laws;
    double per_step; /* (4 pi / 3) / (box volume) / step [1/(m3 s)] */
    double speeds[2 * SPEEDS];
} found_pairs;

/* Half of the pairs belong to one stream, half to two opposed ones: what reversal makes of a common velocity. */
static found_pairs found_pairs_of(const condition *c) {
    found_pairs f;
    granulation_random random = granulation_random_seed(7);
    f.laws = &c->def.laws;
    f.per_step = 4.0 / 3.0 * RIDDLE_PI / pow(2e-3 * cbrt(c->granules / 192.0), 3.0) / c->def.step;
    for (int i = 0; i < 2 * SPEEDS; i++) {
        double square = 0.0;
        for (int k = 0; k < 3; k++) {
            double v = (i < SPEEDS ? 0.0 : 2.0 * c->def.velocity_mean[k]) +
                       sqrt(2.0) * c->def.velocity_deviation[k] * granulation_random_normal(&random);
            square += v * v;
        }
        f.speeds[i] = sqrt(square);
    }
    return f;
}

static double found_kernel(const granulation_granule *i, const granulation_granule *j, const void *user) {
    const found_pairs *f = (const found_pairs *)user;
    granulation_body a = granulation_body_of(f->laws, i), b = granulation_body_of(f->laws, j);
    double r = 0.5 * (a.diameter > b.diameter ? a.diameter : b.diameter), held = 0.0;
    if (!(a.film + b.film > 0.0)) return 0.0;
    for (int k = 0; k < 2 * SPEEDS; k++) held += granulation_collide(f->laws, &a, &b, f->speeds[k]).coalesces;
    return f->per_step * (r * r * r) * held / (2 * SPEEDS);
}

typedef struct curve {
    double q[3][CLASSES][MOST_STEPS + 1]; /* solid, liquid, air by class and step */
    double number[MOST_STEPS + 1], size[MOST_STEPS + 1];
} curve;

/* Table 1 on keys that are multiples of the smallest: no error of the grid at all */
static granulation_status balance_curve(curve *out, const condition *c, granulation_kernel kernel, const void *user,
                                        const double *edges, int steps) {
    double cells[GRID];
    for (int i = 0; i < GRID; i++) cells[i] = 0.85e-12 * (2 * i + 1);
    granulation_balance_def def = granulation_balance_default_def();
    def.kernel = kernel;
    def.kernel_user = user;
    def.kernel_changes = true;
    def.consolidation = c->def.consolidation;
    def.longest_step = 0.5 * c->def.step;
    def.tolerance = 1e-4;
    def.most_lost = 0.05;
    granulation_balance b;
    granulation_status status = granulation_balance_init(&b, &def, GRID - 1, cells, NULL, 0, NULL, NULL);
    for (int i = 0; i < c->granules && status == GRANULATION_OK; i++) {
        granulation_granule g = granule_of(table1_volume(i), c->liquid);
        status = granulation_balance_add(&b, &g, 1.0);
    }
    for (int step = 0; step <= steps && status == GRANULATION_OK; step++) {
        if (step > 0) status = granulation_balance_run(&b, c->def.step);
        for (int k = 0; k < CLASSES; k++) out->q[0][k][step] = out->q[1][k][step] = out->q[2][k][step] = 0.0;
        for (int i = 0; i < b.n; i++) {
            double volume = volume_at_start(b.pivot[0][i]);
            for (int k = 0; k < CLASSES; k++) {
                if (!(volume >= edges[k] && volume < edges[k + 1])) continue;
                out->q[0][k][step] += b.number[i] * b.pivot[0][i] - b.liquid[i];
                out->q[1][k][step] += b.liquid[i];
                out->q[2][k][step] += b.air[i];
            }
        }
        out->number[step] = granulation_balance_moment(&b, 0.0, 0.0);
        out->size[step] = granulation_balance_mean(&b, 4, 3);
    }
    granulation_balance_free(&b);
    return status;
}

/* Pouw's rate constant, such that as many granules are left as in the discrete simulation */
static double fit_pouw(curve *out, const condition *c, granulation_kernel_data *data, const double *edges, int steps,
                       double left) {
    double low = 1e-7, high = 1.0;
    for (int i = 0; i < 16; i++) {
        data->rate = sqrt(low * high);
        granulation_status status = balance_curve(out, c, granulation_saturation_kernel, data, edges, steps);
        if (status == GRANULATION_OK && out->number[steps] > left) low = data->rate;
        else high = data->rate;
    }
    return data->rate;
}

static void write_by_class(json *report, const char *key, const ensemble *e, int quantity, int classes) {
    size_t block = (size_t)(e->steps + 1) * CLASSES;
    json_array_begin(report, key);
    for (int k = 0; k < classes; k++) {
        double values[MOST_STEPS + 1];
        for (int step = 0; step <= e->steps; step++)
            values[step] = over(e, e->records[0].q + (size_t)quantity * block + (size_t)step * CLASSES + k).mean;
        json_array(report, NULL, values, e->steps + 1);
    }
    json_array_end(report);
}

/* Ends the array "rows" and writes solid, liquid and air by class and time after it: the last thing that a study does
   with an ensemble. */
static void end_rows_with_classes(json *report, const ensemble *e, int classes) {
    double time[MOST_STEPS + 1];
    for (int step = 0; step <= e->steps; step++) time[step] = step * e->c->def.step;
    json_array_end(report);
    json_array(report, "time_s", time, e->steps + 1);
    json_array(report, "class_edges_m3", e->edges, classes + 1);
    write_by_class(report, "q_solid", e, 1, classes);
    write_by_class(report, "q_liquid", e, 2, classes);
    write_by_class(report, "q_air", e, 3, classes);
}

/* figure 5, or 7 with a normal start: q of solid, liquid and air by class; balance may be NULL */
static int draw_classes(const program *self, const ensemble *e, const curve *balance, const char *title,
                        const char *file, const char *csv_name, int first, int classes) {
    static const char *const phases[3] = {"solid [10⁻¹⁰ m³]", "liquid [10⁻¹⁰ m³]", "air [10⁻¹⁰ m³]"};
    static double time[MOST_STEPS + 1], y[MOST_STEPS + 1], low[MOST_STEPS + 1], high[MOST_STEPS + 1];
    size_t block = (size_t)(e->steps + 1) * CLASSES;
    riddle_plot *figure = riddle_plot_new(title, 1, 3);
    riddle_io_file *data = csv_open(
        self->out, csv_name, "step,class,solid_m3,liquid_m3,air_m3,balance_solid_m3,balance_liquid_m3,balance_air_m3");
    for (int step = 0; step <= e->steps; step++) {
        time[step] = step;
        for (int k = first; k < classes; k++) {
            double line[8] = {step, k + 1};
            for (int p = 0; p < 3; p++) {
                line[2 + p] = over(e, e->records[0].q + (size_t)(p + 1) * block + (size_t)step * CLASSES + k).mean;
                line[5 + p] = balance ? balance->q[p][k][step] : (double)NAN;
            }
            riddle_io_row(data, line, 8);
        }
    }
    riddle_io_close(data);
    for (int p = 0; p < 3; p++) {
        riddle_plot_panel(figure, 0, p, "step [s]", phases[p]);
        for (int k = first; k < classes; k++) {
            char label[40];
            for (int step = 0; step <= e->steps; step++) {
                granulation_estimate x =
                    over(e, e->records[0].q + (size_t)(p + 1) * block + (size_t)step * CLASSES + k);
                y[step] = 1e10 * x.mean;
                low[step] = 1e10 * (x.mean - x.confidence);
                high[step] = 1e10 * (x.mean + x.confidence);
            }
            snprintf(label, sizeof label, k + 1 < CLASSES ? "%g to %g · 10⁻¹² m³" : "over %g · 10⁻¹² m³",
                     1e12 * e->edges[k], 1e12 * e->edges[k + 1]);
            riddle_plot_line(figure, p == 2 ? label : NULL, time, y, e->steps + 1);
            riddle_plot_style(figure, k - first < 8 ? 0 : RIDDLE_PLOT_DASHED, (k - first) % 8);
            if (balance || classes < 7) {
                riddle_plot_band(figure, NULL, time, low, high, e->steps + 1);
                riddle_plot_style(figure, 0, RIDDLE_PLOT_SAME);
            }
            if (!balance) continue;
            for (int step = 0; step <= e->steps; step++) y[step] = 1e10 * balance->q[p][k][step];
            riddle_plot_line(figure, p == 2 && k == classes - 1 ? "population balance" : NULL, time, y, e->steps + 1);
            riddle_plot_style(figure, RIDDLE_PLOT_DASHED, (k - first) % 8);
        }
        if (p == 2) riddle_plot_legend_outside(figure);
    }
    return (int)riddle_plot_write(figure, self->out, file);
}

static int study_pouw(const program *self, json *report, granulation_def def, int replicates, int steps) {
    static curve laws, pouw;
    static double time[MOST_STEPS + 1], y[MOST_STEPS + 1], low[MOST_STEPS + 1], high[MOST_STEPS + 1];
    double edges[CLASSES + 1];
    condition c = condition_of(def, 360, 0.33);
    table1_classes(edges);
    progress bar;
    progress_begin(&bar, "Table 1", replicates);
    ensemble e = {.c = &c, .edges = edges, .steps = steps, .replicates = replicates, .seed = self->seed, .bar = &bar};
    if (ensemble_run(&e, self)) {
        ensemble_free(&e);
        return -1;
    }
    progress_end(&bar);
    found_pairs pairs = found_pairs_of(&c);
    granulation_status status = balance_curve(&laws, &c, found_kernel, &pairs, edges, steps);
    if (status != GRANULATION_OK) common_fail("population balance: %s", granulation_status_text(status));
    granulation_kernel_data data = granulation_default_kernel_data();
    data.limit = 2.75e-4; /* as large as granules get in the discrete simulation */
    data.laws = &c.def.laws;
    double left = over(&e, e.records[0].number + steps).mean;
    double rate = fit_pouw(&pouw, &c, &data, edges, steps, left);
    draw_classes(self, &e, &laws,
                 "Gantt & Gatzke, Fig 5: their Table 1 by size class, discrete simulation (full) and population "
                 "balance (dashed)",
                 "figure5.svg", "figure5.csv", 0, 5);
    riddle_plot *figure =
        riddle_plot_new("Gantt & Gatzke, Table 1 at 360 rpm: discrete simulation, population balances", 1, 2);
    for (int panel = 0; panel < 2; panel++) {
        double unit = panel ? 1e6 : 1.0;
        riddle_plot_panel(figure, 0, panel, "step [s]", panel ? "mean size d43 [µm]" : "granules [-]");
        for (int step = 0; step <= steps; step++) {
            granulation_estimate x = over(&e, (panel ? e.records[0].size : e.records[0].number) + step);
            time[step] = step;
            y[step] = unit * x.mean;
            low[step] = unit * (x.mean - x.confidence);
            high[step] = unit * (x.mean + x.confidence);
        }
        riddle_plot_line(figure, panel ? "discrete, mean and 95 %" : NULL, time, y, steps + 1);
        riddle_plot_band(figure, NULL, time, low, high, steps + 1);
        riddle_plot_style(figure, 0, RIDDLE_PLOT_SAME);
        for (int step = 0; step <= steps; step++) y[step] = unit * (panel ? laws.size : laws.number)[step];
        riddle_plot_line(figure, panel ? "balance, the same laws" : NULL, time, y, steps + 1);
        riddle_plot_style(figure, RIDDLE_PLOT_DASHED, RIDDLE_PLOT_NEXT);
        for (int step = 0; step <= steps; step++) y[step] = unit * (panel ? pouw.size : pouw.number)[step];
        riddle_plot_line(figure, panel ? "balance, Pouw's kernel, rate fitted" : NULL, time, y, steps + 1);
        riddle_plot_style(figure, RIDDLE_PLOT_DOTTED, RIDDLE_PLOT_NEXT);
    }
    riddle_plot_write(figure, self->out, "balance.svg");
    static const result_column columns[] = {
        {NULL, "after the last step", "%s"}, {NULL, "granules", "%.1f"}, {NULL, "d43 [um]", "%.1f", 1e6}};
    result_table *t = RESULTS(columns);
    char text[60];
    snprintf(text, sizeof text, "discrete, %d replicates", replicates);
    results_row(t, TEXTS(text), left, over(&e, e.records[0].size + steps).mean);
    results_row(t, TEXTS("population balance, the same laws"), laws.number[steps], laws.size[steps]);
    snprintf(text, sizeof text, "Pouw's kernel, rate %.2e a step", rate);
    results_row(t, TEXTS(text), pouw.number[steps], pouw.size[steps]);
    results_print(t);
    results_free(t);
    write_row(report, "pouw", &e);
    end_rows_with_classes(report, &e, 5);
    json_object_begin(report, "balance");
    results_values(report, {"granules", laws.number[steps]}, {"mean_size_m", laws.size[steps]},
                   {"pouw_rate_per_s", rate}, {"pouw_mean_size_m", pouw.size[steps]});
    json_object_end(report);
    ensemble_free(&e);
    return 0;
}

/* figures 6 and 7 */
static int study_normal(const program *self, json *report, granulation_def def, int replicates, int steps) {
    double edges[CLASSES + 1];
    condition normal = condition_of(def, 360, 0.33);
    normal.normal_feed = true;
    ten_classes(edges);
    ensemble f = {.c = &normal, .edges = edges, .steps = steps, .replicates = replicates, .seed = self->seed};
    int bad = ensemble_run(&f, self);
    if (!bad) {
        write_row(report, "normal", &f);
        draw_classes(self, &f, NULL, "Gantt & Gatzke, Fig 7: a normal start, 10 size classes", "figure7.svg",
                     "figure7.csv", 0, CLASSES);
        riddle_plot *figure = riddle_plot_new("Gantt & Gatzke, Fig 6: a normal start, one run", 1, 1);
        riddle_plot_panel(figure, 0, 0, "volume at the feed's air content [10⁻¹² m³]", "granules [-]");
        for (int k = 0; k < 5; k++) {
            int step = k * steps / 4;
            double x[CLASSES], counts[CLASSES];
            char label[30];
            for (int i = 0; i < CLASSES; i++) {
                x[i] = i + 0.5;
                counts[i] = f.records[0].q[(size_t)step * CLASSES + (size_t)i];
            }
            snprintf(label, sizeof label, "step %d", step);
            riddle_plot_line(figure, label, x, counts, CLASSES);
            riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
        }
        riddle_plot_write(figure, self->out, "figure6.svg");
    }
    ensemble_free(&f);
    return bad;
}

/* ---- map: figure 10 ---- */

typedef struct events {
    granulation_event *list;
    int n, most;
} events;

static void keep(void *user, const granulation_event *e) {
    events *all = (events *)user;
    if (all->n < all->most) all->list[all->n++] = *e;
}

enum { MAP_MOST = 200000, MAP_SIDE = 140, MAP_KINDS = 4 };
/* Collisions in the plane of the Stokes numbers, by their outcome: St_def and St_v of each. */
typedef struct outcome_plane {
    double (*at)[2][MAP_MOST]; /* [MAP_KINDS] */
    int n[MAP_KINDS];
} outcome_plane;

/* Draws the outcomes that the population would have at a step. */
static granulation_status draw_outcomes(const granulation_sim *sim, const condition *c, int k, int step,
                                        riddle_plot *map) {
    static const char *const outcomes[3] = {"rebound", "Type I", "Type II"};
    double film = 0.0, cells[MAP_SIDE * MAP_SIDE], st_v[MAP_SIDE], st_def[MAP_SIDE];
    granulation_reason reasons[MAP_SIDE * MAP_SIDE];
    const double ha = granulation_asperity(c->def.laws.asperity_factor, c->def.laws.grain_diameter);
    for (int i = 0; i < sim->n; i++) film += sim->body[i].film / sim->n;
    for (int i = 0; i < MAP_SIDE; i++) {
        st_v[i] = pow(10.0, -1.0 + 3.0 * (i + 0.5) / MAP_SIDE);
        st_def[i] = pow(10.0, -7.0 + 7.0 * (i + 0.5) / MAP_SIDE);
    }
    const granulation_status status = granulation_sim_map(sim, st_v, MAP_SIDE, st_def, MAP_SIDE, reasons);
    for (int i = 0; i < MAP_SIDE * MAP_SIDE; i++)
        cells[i] = reasons[i] == GRANULATION_TYPE_I ? 1.0 : reasons[i] <= GRANULATION_TYPE_II_DRY ? 2.0 : 0.0;
    char title[60];
    snprintf(title, sizeof title, "step %d, h₀/hₐ = %.1f", step, film / ha);
    riddle_plot_panel(map, 0, k, "log₁₀ St_def", "log₁₀ St_v");
    riddle_plot_title(map, title);
    riddle_plot_heat(map, "", cells, MAP_SIDE, MAP_SIDE, -7.0, 0.0, -1.0, 2.0);
    riddle_plot_heat_classes(map, outcomes, 3);
    return status;
}

/* Runs the replicates, whose collisions c keeps; draws map.svg from the first. */
static granulation_status run_map(const program *self, const condition *c, int runs, int steps) {
    riddle_plot *map = riddle_plot_new("Coalescence boundaries of the population as it is", 1, 3);
    const int when[3] = {steps / 4, steps / 2, steps};
    granulation_status status = GRANULATION_OK;
    for (int run = 0; run < runs && status == GRANULATION_OK; run++) {
        granulation_sim sim;
        status = start(&sim, c, program_seed_of(self->seed, (uint64_t)run));
        for (int k = 0, done = 0; k < 3 && status == GRANULATION_OK; done = when[k++]) {
            status = granulation_sim_run(&sim, when[k] - done);
            if (run == 0 && status == GRANULATION_OK) status = draw_outcomes(&sim, c, k, when[k], map);
        }
        granulation_sim_free(&sim);
    }
    if (status == GRANULATION_OK) riddle_plot_write(map, self->out, "map.svg");
    else riddle_plot_free(map);
    return status;
}

/* Sorts the collisions by outcome, and writes all of them. */
static void sort_collisions(const program *self, const events *all, outcome_plane *p) {
    riddle_io_file *file = csv_open(self->out, "figure10.csv", "step,st_v,st_def,reason,both");
    memset(p->n, 0, sizeof p->n);
    for (int i = 0; i < all->n; i++) {
        const granulation_collision *x = &all->list[i].collision;
        const int kind = !x->coalesces ? 0 : x->reason != GRANULATION_TYPE_I ? 1 : x->both ? 3 : 2;
        p->at[kind][0][p->n[kind]] = x->st_def;
        p->at[kind][1][p->n[kind]++] = x->st_v;
        csv_line(file, "%g,%.9g,%.9g,%d,%d", all->list[i].time, x->st_v, x->st_def, (int)x->reason, (int)x->both);
    }
    riddle_io_close(file);
}

static void draw_collisions(const program *self, const outcome_plane *p) {
    static const char *const names[MAP_KINDS] = {"rebound", "Type II", "Type I", "Type I, eq 21 met, too"};
    riddle_plot *figure =
        riddle_plot_new("Gantt & Gatzke, Fig 10: every collision in the plane of the Stokes numbers", 1, 1);
    riddle_plot_panel_size(figure, 620, 430);
    riddle_plot_panel(figure, 0, 0, "Stokes deformation number St_def [-]", "viscous Stokes number St_v [-]");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    for (int k = 0; k < MAP_KINDS; k++) {
        if (!p->n[k]) continue;
        riddle_plot_points(figure, names[k], p->at[k][0], p->at[k][1], p->n[k] > 1500 ? 1500 : p->n[k]);
        if (k == 0) riddle_plot_style(figure, RIDDLE_PLOT_FAINT, RIDDLE_PLOT_GREY);
    }
    riddle_plot_legend_outside(figure);
    riddle_plot_write(figure, self->out, "figure10.svg");
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}
/* Returns the median along an axis; sorts that axis. */
static double median_of(outcome_plane *p, int kind, int axis) {
    qsort(p->at[kind][axis], (size_t)p->n[kind], sizeof(double), ascending);
    return p->n[kind] ? p->at[kind][axis][p->n[kind] / 2] : (double)NAN;
}

static void tell_collisions(json *report, outcome_plane *p, int all, int runs) {
    double share[MAP_KINDS];
    for (int k = 0; k < MAP_KINDS; k++) share[k] = all ? 100.0 * p->n[k] / all : 0.0;
    const int type1 = p->n[2] >= p->n[3] ? 2 : 3;
    static const result_column columns[] = {{NULL, "figure 10", "%s"},
                                            {NULL, "rebound [%]", "%.1f"},
                                            {NULL, "Type II [%]", "%.1f"},
                                            {NULL, "Type I only [%]", "%.1f"},
                                            {NULL, "Type I, eq 21 met, too [%]", "%.1f"},
                                            {NULL, "events a run", "%.0f"},
                                            {NULL, "St_v II / I", "%.1f"},
                                            {NULL, "St_def II / I", "%.0f"}};
    result_table *t = RESULTS(columns);
    const double a_run = (double)all / runs, st_v = median_of(p, 1, 1) / median_of(p, type1, 1),
                 st_def = median_of(p, 1, 0) / median_of(p, type1, 0);
    results_row(t, TEXTS("here, a mean run"), share[0], share[1], share[2], share[3], a_run, st_v, st_def);
    results_row(t, TEXTS("paper, one run, its ratios about"), 82, 12, 2, 4, 320, 10, 100);
    results_print(t);
    results_free(t);
    json_object_begin(report, NULL);
    json_string(report, "study", "map");
    results_values(report, {"rpm", 360}, {"binder", 0.33}, {"replicates", runs}, {"rebound_pct", share[0]},
                   {"type2_pct", share[1]}, {"type1_pct", share[2] + share[3]}, {"both_pct", share[3]},
                   {"interactions", a_run}, {"st_v_type2_over_type1", st_v}, {"st_def_type2_over_type1", st_def});
    json_object_end(report);
}

static int study_map(const program *self, json *report, granulation_def def, int runs, int steps) {
    events all = {(granulation_event *)malloc(MAP_MOST * sizeof(granulation_event)), 0, MAP_MOST};
    outcome_plane p = {(double(*)[2][MAP_MOST])malloc(MAP_KINDS * sizeof *p.at), {0}};
    condition c = condition_of(def, 360, 0.33);
    c.def.contact = GRANULATION_CONTACT_SMALLER; /* the reading that gives figure 10 its 320 events */
    c.def.on_collision = keep;
    c.def.collision_user = &all;
    const granulation_status status = all.list && p.at ? run_map(self, &c, runs, steps) : GRANULATION_NO_MEMORY;
    if (status == GRANULATION_OK) {
        sort_collisions(self, &all, &p);
        draw_collisions(self, &p);
        tell_collisions(report, &p, all.n, runs);
    }
    free(all.list);
    free(p.at);
    return status == GRANULATION_OK ? 0 : common_fail("map: %s", granulation_status_text(status));
}

/* ---- midbatch: what the paper wants the method for ---- */

static int study_midbatch(const program *self, json *report, granulation_def def, int replicates, int steps) {
    static double time[MOST_STEPS + 1], y[4][4][MOST_STEPS + 1];
    const change changes[4] = {{-1, -1, -1, 0, 0, 0},
                               {steps * 3 / 10, -1, -1, 0.06, 0, 0},
                               {-1, steps / 2, -1, 0, 120.0, 0},
                               {steps * 3 / 10, steps / 2, steps * 7 / 10, 0.06, 120.0, 290.0}};
    char texts[4][60] = {"unchanged, 360 rpm"};
    unsigned outside[4] = {0};
    const char *names[4] = {texts[0], texts[1], texts[2], texts[3]};
    snprintf(texts[1], sizeof texts[1], "+ 6 %% binder at %d s", changes[1].spray_step);
    snprintf(texts[2], sizeof texts[2], "120 rpm from %d s", changes[2].impeller_step);
    snprintf(texts[3], sizeof texts[3], "both, 8 K colder at %d s", changes[3].cool_step);
    double edges[CLASSES + 1];
    condition c = condition_of(def, 360, 0.33);
    ten_classes(edges);
    static const result_column columns[] = {{NULL, "mid-batch", "%s"},      {NULL, "Type I [%]", "%.1f"},
                                            {NULL, "Type II [%]", "%.1f"},  {NULL, "d43 [um]", "%.1f", 1e6},
                                            {NULL, "+- 95 %", "%.1f", 1e6}, {NULL, "granules", "%.1f"}};
    result_table *t = RESULTS(columns);
    progress bar;
    progress_begin(&bar, "changes in mid-batch", 4.0 * replicates);
    int bad = 0;
    for (int k = 0; k < 4 && !bad; k++) {
        ensemble e = {.c = &c,
                      .change = changes + k,
                      .edges = edges,
                      .steps = steps,
                      .replicates = replicates,
                      .seed = self->seed,
                      .bar = &bar};
        bad = ensemble_run(&e, self);
        if (!bad) {
            outside[k] = outside_in_most(&e);
            write_row(report, names[k], &e);
            const granulation_estimate size = result_of(&e, 4);
            results_row(t, TEXTS(names[k]), result_of(&e, 0).mean, result_of(&e, 1).mean, size.mean, size.confidence,
                        result_of(&e, 7).mean);
            for (int step = 0; step <= steps; step++) {
                const record *r = e.records;
                time[step] = step;
                y[0][k][step] = 1e6 * over(&e, r->size + step).mean;
                y[1][k][step] = over(&e, r->number + step).mean;
                y[2][k][step] = 1e9 * over(&e, r->film + step).mean;
                double sum = 0.0;
                int from = step > 5 ? step - 5 : 1, to = step < steps - 5 ? step + 5 : steps;
                for (int s = from; s <= to; s++) sum += over(&e, r->success + s).mean;
                y[3][k][step] = 100.0 * sum / (to - from + 1);
            }
        }
        ensemble_free(&e);
    }
    progress_end(&bar);
    results_print(t);
    results_free(t);
    if (bad) return bad;
    for (int k = 0; k < 4; k++) {
        say_outside(texts[k], outside[k]);
        if (outside[k]) strncat(texts[k], " (outside the fit)", sizeof texts[k] - strlen(texts[k]) - 1);
    }
    riddle_plot *figure = riddle_plot_new("Operating conditions that change in mid-batch", 2, 2);
    const char *const labels[4] = {"mean size d43 [µm]", "granules [-]", "mean binder film [nm]",
                                   "coalescing collisions [%]"};
    for (int p = 0; p < 4; p++) {
        riddle_plot_panel(figure, p / 2, p % 2, "step [s]", labels[p]);
        for (int k = 0; k < 4; k++) {
            riddle_plot_line(figure, p == 1 ? names[k] : NULL, time, y[p][k], steps + 1);
            if (k == 3) riddle_plot_style(figure, RIDDLE_PLOT_DASHED, RIDDLE_PLOT_NEXT);
        }
        if (p == 1) riddle_plot_legend_outside(figure);
    }
    result_table *courses = results_of("step,d43_unchanged_um,d43_spray_um,d43_slow_um,d43_all_um");
    for (int step = 0; step <= steps; step++)
        results_row(courses, NULL, step, y[0][0][step], y[0][1][step], y[0][2][step], y[0][3][step]);
    results_csv(courses, self->out, "midbatch.csv");
    results_free(courses);
    return (int)riddle_plot_write(figure, self->out, "midbatch.svg");
}

/* ---- sound: physically sounder readings ---- */

enum { READINGS = 8 };

static granulation_def reading(int k, const char **name) {
    static const char *const names[READINGS] = {
        "G1, as the tables were fitted", "G1, momentum conserved", "G1, swept, sum of radii", "swept, conserved",
        "the same, stirred each step",   "the same, random signs", "the same, two streams",   "two streams, refitted"};
    granulation_def def = k < 3 ? granulation_paper_def() : granulation_default_def();
    *name = names[k];
    if (k == 1) def.bounce = GRANULATION_CONSERVING;
    if (k == 2) {
        def.detection = GRANULATION_SWEPT;
        def.contact = GRANULATION_CONTACT_SUM;
    }
    if (k >= 2) def.dilation = 1e5; /* as many collisions as the tables have, roughly */
    if (k >= 4) def.stirring = 1.0;
    if (k == 5) def.signs = GRANULATION_RANDOM_SIGNS;
    if (k == 6) def.signs = GRANULATION_TWO_STREAMS;
    return k == READINGS - 1 ? sound_def() : def;
}

static int study_sound(const program *self, json *report, int replicates, int steps) {
    double edges[CLASSES + 1], points[READINGS], microns[READINGS], last[3][6], paper[3][6];
    const char *short_names[READINGS] = {"G1",      "+ conserved", "+ swept", "swept, cons.",
                                         "stirred", "signs",       "streams", "refitted"};
    const char *conditions[6] = {"120 rpm", "360", "720", "840", "15 %", "25 %"};
    ten_classes(edges);
    riddle_io_table t = riddle_io_table_begin("reading|mean error I, II [points]|mean error d43 [um]|interactions|I / "
                                              "II at 120|360|720|840 rpm|15 %|25 % binder");
    riddle_io_file *file = csv_open(
        self->out, "sound.csv",
        "reading,rpm,binder,type1_pct,type2_pct,d43_m,interactions,paper_type1_pct,paper_type2_pct,paper_d43_m");
    progress bar;
    progress_begin(&bar, "sounder readings", 6.0 * READINGS * replicates);
    int bad = 0;
    for (int k = 0; k < READINGS && !bad; k++) {
        const char *name;
        granulation_def def = reading(k, &name);
        double one[6], two[6], met = 0.0;
        points[k] = microns[k] = 0.0;
        for (int i = 0; i < 6 && !bad; i++) {
            condition c = condition_of(def, paper_rows[i].rpm, paper_rows[i].liquid);
            ensemble e = {
                .c = &c, .edges = edges, .steps = steps, .replicates = replicates, .seed = self->seed, .bar = &bar};
            bad = ensemble_run(&e, self);
            if (!bad) {
                one[i] = last[0][i] = result_of(&e, 0).mean;
                two[i] = last[1][i] = result_of(&e, 1).mean;
                last[2][i] = 1e6 * result_of(&e, 4).mean;
                paper[0][i] = paper_rows[i].type1;
                paper[1][i] = paper_rows[i].type2;
                paper[2][i] = paper_rows[i].size_um;
                points[k] += (fabs(one[i] - paper[0][i]) + fabs(two[i] - paper[1][i])) / 12.0;
                microns[k] += fabs(last[2][i] - paper[2][i]) / 6.0;
                met += result_of(&e, 5).mean / 6.0;
                write_row(report, name, &e);
                csv_line(file, "%d,%g,%g,%.6g,%.6g,%.6g,%.6g,%g,%g,%g", k, c.rpm, c.liquid, one[i], two[i],
                         1e-6 * last[2][i], result_of(&e, 5).mean, paper[0][i], paper[1][i], 1e-6 * paper[2][i]);
            }
            ensemble_free(&e);
        }
        if (bad) break;
        riddle_io_table_cell(&t, "%s", name);
        riddle_io_table_cell(&t, "%.2f", points[k]);
        riddle_io_table_cell(&t, "%.1f", microns[k]);
        riddle_io_table_cell(&t, "%.0f", met);
        for (int i = 0; i < 6; i++) riddle_io_table_cell(&t, "%.1f / %.1f", one[i], two[i]);
    }
    progress_end(&bar);
    table_end(&t);
    riddle_io_close(file);
    if (bad) return bad;
    riddle_plot *figure = riddle_plot_new(
        "Physically sounder readings of Gantt & Gatzke (G1: as printed; docs/granulation.md explains the others)", 2,
        2);
    riddle_plot_panel_size(figure, 560, 280);
    riddle_plot_panel(figure, 0, 0, "reading", "error of Types I, II [% of collisions]");
    riddle_plot_bars(figure, NULL, short_names, points, READINGS);
    riddle_plot_panel(figure, 0, 1, "reading", "mean error of d43 [µm]");
    riddle_plot_bars(figure, NULL, short_names, microns, READINGS);
    riddle_plot_panel(figure, 1, 0, "condition (refitted reading)", "Type I [% of collisions]");
    riddle_plot_bars(figure, "granulation.h", conditions, last[0], 6);
    riddle_plot_bars(figure, "paper", conditions, paper[0], 6);
    riddle_plot_panel(figure, 1, 1, "condition (refitted reading)", "Type II [% of collisions]");
    riddle_plot_bars(figure, "granulation.h", conditions, last[1], 6);
    riddle_plot_bars(figure, "paper", conditions, paper[1], 6);
    return (int)riddle_plot_write(figure, self->out, "sound.svg");
}

/* ---- custom ---- */

/* the granules of one run every tenth of the way, for ParaView */
static void write_granules(const program *self, const condition *c, int steps) {
    granulation_sim sim;
    granulation_status status = start(&sim, c, self->seed);
    riddle_io_series *series = riddle_io_series_open(self->out, "granules.pvd");
    for (int frame = 0, done = 0; frame <= 10 && status == GRANULATION_OK && !common_interrupted(); frame++) {
        int to = steps * frame / 10;
        if (to > done) status = granulation_sim_run(&sim, to - done);
        done = to;
        double *radius = (double *)malloc((size_t)sim.n * 2 * sizeof *radius);
        if (!radius || status != GRANULATION_OK) {
            free(radius);
            break;
        }
        for (int i = 0; i < sim.n; i++) {
            radius[i] = 0.5 * sim.body[i].diameter;
            radius[sim.n + i] = sim.body[i].film;
        }
        riddle_io_array arrays[] = {riddle_io_scalar("radius", radius), riddle_io_scalar("film_m", radius + sim.n),
                                    riddle_io_vector3("velocity", sim.vx, sim.vy, sim.vz)};
        riddle_io_points(self->out, riddle_io_series_name(series, sim.time), sim.n,
                         riddle_io_vector3("position", sim.x, sim.y, sim.z), arrays, 3);
        free(radius);
    }
    riddle_io_series_close(series);
    granulation_sim_free(&sim);
    if (status != GRANULATION_OK) common_fail("granules: %s", granulation_status_text(status));
}

static int study_custom(const program *self, json *report, granulation_def def, double rpm, double liquid, int granules,
                        bool normal, bool frames, int replicates, int steps) {
    static double time[MOST_STEPS + 1], y[MOST_STEPS + 1], low[MOST_STEPS + 1], high[MOST_STEPS + 1];
    double edges[CLASSES + 1];
    condition c = condition_of(def, rpm, liquid);
    c.granules = granules;
    c.normal_feed = normal;
    ten_classes(edges);
    progress bar;
    progress_begin(&bar, "replicates", replicates);
    ensemble e = {.c = &c, .edges = edges, .steps = steps, .replicates = replicates, .seed = self->seed, .bar = &bar};
    if (ensemble_run(&e, self)) {
        ensemble_free(&e);
        return -1;
    }
    progress_end(&bar);
    if (frames) write_granules(self, &c, steps);
    write_row(report, "custom", &e);
    result_table *t = RESULTS(row_columns),
                 *course = results_of("step,d43_m,d43_ci95,granules,granules_ci95,film_m,coalescing_share");
    add_row(t, &e);
    results_print(t);
    results_free(t);
    const unsigned outside = outside_in_most(&e);
    say_outside("This case", outside);
    riddle_plot *figure = riddle_plot_new(
        outside ? "Mean over the replicates with its 95 % interval: an extrapolation, outside the data of the fit"
                : "Mean over the replicates with its 95 % interval",
        1, 3);
    static const char *const labels[3] = {"mean size d43 [µm]", "granules [-]", "mean binder film [nm]"};
    static const double units[3] = {1e6, 1.0, 1e9};
    for (int p = 0; p < 3; p++) {
        const double *first = p == 0 ? e.records[0].size : p == 1 ? e.records[0].number : e.records[0].film;
        for (int step = 0; step <= steps; step++) {
            granulation_estimate x = over(&e, first + step);
            time[step] = step;
            y[step] = units[p] * x.mean;
            low[step] = units[p] * (x.mean - x.confidence);
            high[step] = units[p] * (x.mean + x.confidence);
        }
        riddle_plot_panel(figure, 0, p, "step [s]", labels[p]);
        riddle_plot_line(figure, NULL, time, y, steps + 1);
        riddle_plot_band(figure, NULL, time, low, high, steps + 1);
        riddle_plot_style(figure, 0, RIDDLE_PLOT_SAME);
    }
    for (int step = 0; step <= steps; step++) {
        granulation_estimate size = over(&e, e.records[0].size + step), number = over(&e, e.records[0].number + step);
        results_row(course, NULL, step, size.mean, size.confidence, number.mean, number.confidence,
                    over(&e, e.records[0].film + step).mean, over(&e, e.records[0].success + step).mean);
    }
    results_csv(course, self->out, "custom.csv");
    results_free(course);
    end_rows_with_classes(report, &e, CLASSES);
    ensemble_free(&e);
    return (int)riddle_plot_write(figure, self->out, "custom.svg");
}

int main(int argc, char **argv) {
    enum { ALL, POUW, IMPELLER, BINDER, MAP, MIDBATCH, SOUND, CUSTOM };
    int study = ALL, replicates = 50, steps = 100, granules = 192, feed = 0, readings = 0;
    bool frames = false;
    double rpm = 360, binder = 33, viscosity = 0.035, ratio = 0.04, tension = 0.048, rate = 0.0425, breakage = 0.2,
           saturation = 0.85, stirring = 0;
    option options[] = {
        option_choice("study", &study, "all|pouw|impeller|binder|map|midbatch|sound|custom", "which study"),
        option_int("replicates", "N", &replicates, 1, MOST_REPLICATES, "runs with different seeds; --quick: 10"),
        option_int("steps", "N", &steps, 4, MOST_STEPS, "steps of 1 s"),
        option_choice("readings", &readings, "paper|sound", "paper: set G1; sound: swept, momentum conserved, stirred"),
        option_positive("viscosity", "PA_S", &viscosity, 1e6, "of the binder [Pa s]"),
        option_positive("yield-ratio", "X", &ratio, 1.0, "yield stress over effective modulus [-]"),
        option_positive("surface-tension", "N_PER_M", &tension, 10.0, "of the binder [N/m]"),
        option_double("consolidation", "PER_S", &rate, 0.0, 100.0, "rate constant [1/s]"),
        option_positive("breakage-stokes", "X", &breakage, 1e6, "critical Stokes deformation number of breakage [-]"),
        option_double("critical-saturation", "X", &saturation, 0.01, 1.0,
                      "pore saturation at which binder appears on the surface [-]"),
        option_double("rpm", "N", &rpm, 0.0, 1e5, "impeller speed, custom [1/min]"),
        option_double("binder", "PCT", &binder, 1.0, 80.0,
                      "liquid in the feed, custom [% of the volume]; air 15, the rest solid"),
        option_int("granules", "N", &granules, 2, 100000, "granules, custom; the box keeps the paper's density"),
        option_choice("feed", &feed, "table1|normal", "sizes at the start, custom"),
        option_flag("vtp", &frames, "custom: granules of one run as a series for ParaView"),
        option_double("stirring", "PER_S", &stirring, 0.0, 1e3,
                      "custom: share of the granules that get a new velocity in a second [1/s]"),
    };
    program self =
        program_start("granulator",
                      "High-shear granulation, discrete simulation and population balance: Tables 1 to 3 and figures 5 "
                      "to 10 of Gantt and "
                      "Gatzke, changes in mid-batch, or a case of your own. Writes SVG figures and CSV tables.",
                      options, sizeof options / sizeof *options, argc, argv);
    if (self.quick && !is_given(&self, "replicates")) replicates = 10;
    static const char *const of_custom[] = {"rpm", "binder", "granules", "feed", "vtp", "stirring"};
    for (size_t k = 0; k < sizeof of_custom / sizeof *of_custom; k++)
        if (study != CUSTOM && is_given(&self, of_custom[k]))
            program_refuse(&self, of_custom[k], NULL, "only with --study custom");
    granulation_def def = readings ? sound_def() : granulation_paper_def();
    if (is_given(&self, "viscosity")) def.laws.viscosity = viscosity;
    if (is_given(&self, "yield-ratio")) def.laws.yield_ratio = ratio;
    if (is_given(&self, "surface-tension")) def.laws.surface_tension = tension;
    if (is_given(&self, "consolidation")) def.consolidation = rate;
    if (is_given(&self, "breakage-stokes")) def.laws.breakage_stokes = breakage;
    if (is_given(&self, "critical-saturation")) def.laws.critical_saturation = saturation;
    if (is_given(&self, "stirring")) def.stirring = stirring;
    const char *field = NULL;
    if (granulation_check_def(&def, &field) != GRANULATION_OK)
        program_refuse(&self, "readings", field, "a definition that is allowed");

    json *report = json_open(self.json);
    json_string(report, "readings", readings ? "sound" : "paper");
    json_integer(report, "replicates", replicates);
    json_array_begin(report, "rows");
    int bad = 0;
    if (!bad && (study == ALL || study == IMPELLER)) {
        condition c[4] = {condition_of(def, 120, 0.33), condition_of(def, 360, 0.33), condition_of(def, 720, 0.33),
                          condition_of(def, 840, 0.33)};
        bad = study_rows(&self, report, "impeller", c, 4, replicates, steps);
    }
    if (!bad && (study == ALL || study == BINDER)) {
        condition c[4] = {condition_of(def, 360, 0.15), condition_of(def, 360, 0.25), condition_of(def, 360, 0.33),
                          condition_of(def, 360, 0.40)};
        bad = study_rows(&self, report, "binder", c, 4, replicates, steps);
    }
    if (!bad && (study == ALL || study == MAP))
        bad = study_map(&self, report, def, replicates < 20 ? replicates : 20, steps);
    if (!bad && (study == ALL || study == MIDBATCH)) bad = study_midbatch(&self, report, def, replicates, steps);
    if (!bad && (study == ALL || study == SOUND))
        bad = study_sound(&self, report, self.quick ? 3 : replicates < 20 ? replicates : 20, steps);
    if (!bad && (study == ALL || study == POUW)) bad = study_normal(&self, report, def, replicates, steps);
    /* the last one ends the rows, because its classes stand after them */
    if (!bad && study == CUSTOM)
        bad = study_custom(&self, report, def, rpm, binder / 100.0, granules, feed == 1, frames, replicates, steps);
    else if (!bad && (study == ALL || study == POUW)) bad = study_pouw(&self, report, def, replicates, steps);
    else json_array_end(report);
    json_program(report, &self);
    if (bad || common_interrupted()) json_discard(report);
    else json_close(report);
    return common_exit_status();
}
