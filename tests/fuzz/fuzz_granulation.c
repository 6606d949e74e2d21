/* Any program of public calls of granulation.h: a simulation, a population balance and a Monte Carlo, each twice with
   the same calls, the second short of memory now and then. Both must answer the same, with a status that the call
   documents; refused calls change nothing; a run that was stopped and taken up again ends with the same bits; volumes
   are those that came in; nothing is left in memory. */
#include "../failing_allocator.h"
#include "granulation.h"
#include "programs.h"

enum { NUMBERS = 12, MOST = 150 };
typedef struct call {
    int kind, pick, odd;
    double u[NUMBERS], value;
} call;

static double number(const call *c, int k, double low, double high) {
    return c->odd == k ? c->value : low + (high - low) * c->u[k];
}
static double decade(const call *c, int k, double low, double high) {
    return c->odd == k ? c->value : low * riddle_exp(riddle_log(high / low) * c->u[k]);
}
static call draw_call(fuzz_draws *d, int kinds) {
    call c;
    c.kind = fuzz_one_of(d, kinds), c.pick = fuzz_one_of(d, 1 << 20);
    for (int k = 0; k < NUMBERS; k++) c.u[k] = fuzz_uniform(d);
    c.odd = fuzz_one_of(d, 10) == 0 ? fuzz_one_of(d, NUMBERS) : -1;
    c.value = fuzz_hostile_number(d);
    return c;
}
static granulation_granule granule(const call *c) {
    const double v = decade(c, 0, 5e-13, 1e-11);
    granulation_granule g;
    g.s = number(c, 1, 0.3, 0.8) * v, g.l = number(c, 2, 0.0, 0.4) * v, g.a = number(c, 3, 0.0, 0.4) * v;
    return g;
}
static void is_finite(double v) { FUZZ_HOLDS(fabs(v) <= DBL_MAX); }
static void near_to(double v, double expected, double scale) {
    FUZZ_HOLDS(fabs(v - expected) <= 1e-9 * scale + 1e-300);
} /* subnormal parts round */

/* ---- simulation ---- */

enum { ADD, ADD_MANY, PUT, RUN, RUN_MORE, SET, IMPELLER, SPRAY, READ, SIM_CALLS };

static uint64_t sim_digest(const granulation_sim *s) {
    uint64_t hash = 0xcbf29ce484222325u;
    fuzz_mix_bits(&hash, (uint64_t)s->n), fuzz_mix_bits(&hash, (uint64_t)s->steps);
    fuzz_mix_number(&hash, s->time), fuzz_mix_number(&hash, s->owed);
    for (int i = 0; i < s->n; i++) {
        const double of[] = {s->x[i],
                             s->y[i],
                             s->z[i],
                             s->vx[i],
                             s->vy[i],
                             s->vz[i],
                             s->body[i].volumes.s,
                             s->body[i].volumes.l,
                             s->body[i].volumes.a};
        for (size_t k = 0; k < sizeof of / sizeof *of; k++) fuzz_mix_number(&hash, of[k]);
    }
    return hash;
}

static granulation_def changed_def(const granulation_sim *s, const call *c) {
    granulation_def def = s->def;
    def.laws.viscosity = decade(c, 0, 1e-3, 1.0), def.laws.asperity_factor = number(c, 1, 0.01, 1.0);
    def.step = number(c, 2, 0.1, 2.0), def.dilation = decade(c, 3, 3e3, 1e5);
    def.restitution = number(c, 4, 0.0, 1.0), def.stirring = number(c, 5, 0.0, 0.5),
    def.consolidation = number(c, 6, 0.0, 0.2);
    def.breakage = c->pick % 2, def.detection = (granulation_detection)(c->pick / 2 % 2);
    def.contact = (granulation_contact)(c->pick / 4 % 2), def.bounce = (granulation_bounce)(c->pick / 8 % 2);
    def.signs = (granulation_signs)(c->pick / 16 % 3), def.restitution_of_law = c->pick / 64 % 2;
    def.most_granules = 4 * MOST, def.most_events = 200, def.place_attempts = 50;
    return def;
}

static granulation_status sim_call(granulation_sim *s, const call *c) {
    const granulation_granule g = granule(c);
    const granulation_granule many[3] = {g, g, g};
    const double centre[3] = {number(c, 4, 0.0, s->def.box), number(c, 5, 0.0, s->def.box),
                              number(c, 6, 0.0, s->def.box)};
    const double velocity[3] = {number(c, 7, -3.0, 3.0), number(c, 8, -3.0, 3.0), number(c, 9, -3.0, 3.0)};
    const double deviation[3] = {number(c, 4, 0.0, 2.0), number(c, 5, 0.0, 2.0), number(c, 6, 0.0, 2.0)};
    granulation_def def = changed_def(s, c);
    double overlap = 0.0;
    switch (c->kind) {
    case ADD: return s->n < MOST ? granulation_sim_add(s, &g, c->odd == 11 ? -1 : c->pick % 20) : GRANULATION_OK;
    case ADD_MANY: return s->n < MOST ? granulation_sim_add_many(s, many, c->odd == 11 ? -1 : 3) : GRANULATION_OK;
    case PUT: return granulation_sim_put(s, &g, centre, velocity);
    case SET: return granulation_sim_set(s, &def);
    case IMPELLER: return granulation_sim_impeller(s, velocity, deviation, c->pick % 2);
    case SPRAY: return granulation_sim_spray(s, number(c, 0, 0.0, 1e-12), number(c, 1, 0.0, 1.0));
    case READ: return granulation_sim_overlap(s, &overlap);
    default: return granulation_sim_run(s, c->odd == 11 ? -1 : 1 + c->pick % 4);
    }
}

static int sim_may_answer(const call *c, granulation_status status) {
    const int runs = c->kind == RUN || c->kind == RUN_MORE, adds = c->kind <= PUT;
    switch (status) {
    case GRANULATION_OK:
    case GRANULATION_BAD_ARGUMENT: return 1;
    case GRANULATION_BAD_DEF: return c->kind == SET;
    case GRANULATION_NO_ROOM: return adds && c->kind != PUT;
    case GRANULATION_TOO_LARGE: return adds || runs || c->kind == SPRAY;
    case GRANULATION_POPULATION:
    case GRANULATION_EVENTS: return runs;
    default: return 0;
    }
}

/* What is there is what came in, and every number is one. */
static void volumes_are_kept(const granulation_sim *s) {
    granulation_granule sum;
    double momentum[3], kinetic;
    granulation_sim_totals(s, &sum, momentum, &kinetic);
    const granulation_ledger *in = &s->ledger;
    near_to(sum.s, in->solid, in->solid), near_to(sum.l, in->liquid, in->liquid + sum.l);
    near_to(sum.a, in->air - in->air_released, in->air + sum.a);
    is_finite(kinetic), is_finite(s->tally.kinetic_loss);
    for (int i = 0; i < s->n; i++)
        FUZZ_HOLDS(s->x[i] >= 0.0 && s->x[i] < s->def.box && s->y[i] >= 0.0 && s->y[i] < s->def.box && s->z[i] >= 0.0 &&
                   s->z[i] < s->def.box);
}

/* The call with one allocation that fails; what was stopped is taken up again. *left: the rest of the last step is
   still to be done, which a run of one step more does first. */
static granulation_status short_of_memory(granulation_sim *s, failing_allocator *m, const call *c, int fail_at,
                                          int *left) {
    const int64_t steps = s->steps, asked = c->kind == RUN || c->kind == RUN_MORE ? 1 + c->pick % 4 : 0;
    const double time = s->time;
    m->fail_at = m->calls + fail_at, m->fail_count = 1;
    const granulation_status status = sim_call(s, c);
    m->fail_at = -1;
    if (status != GRANULATION_NO_MEMORY) return status;
    if (asked == 0) return sim_call(s, c);
    const int64_t begun = (int64_t)floor((s->time - time) / s->def.step + 0.5);
    FUZZ_HOLDS(begun == s->steps - steps + 1); /* time counts a step from its beginning, steps from its end */
    *left = begun == asked;
    return *left ? GRANULATION_OK : granulation_sim_run(s, (int)(asked - begun));
}

static uint64_t simulate(fuzz_draws *d) {
    granulation_sim side[2];
    failing_allocator memory[2];
    granulation_def def = fuzz_one_of(d, 2) ? granulation_default_def() : granulation_paper_def();
    def.box = 1e-3, def.seed = 1 + (uint64_t)fuzz_one_of(d, 1000);
    for (int k = 0; k < 2; k++) {
        failing_init(&memory[k]);
        def.memory.fn = failing_fn, def.memory.user = &memory[k];
        FUZZ_HOLDS(granulation_sim_init(&side[k], &def) == GRANULATION_OK);
    }
    for (int calls = 5 + fuzz_one_of(d, 15); calls > 0; calls--) {
        const call c = draw_call(d, SIM_CALLS);
        const uint64_t before = sim_digest(&side[0]);
        const int fails = fuzz_one_of(d, 8) == 0 && c.kind >= RUN, fail_at = fuzz_one_of(d, 4);
        int left = 0;
        const granulation_status a = sim_call(&side[0], &c),
                                 b = fails ? short_of_memory(&side[1], &memory[1], &c, fail_at, &left)
                                           : sim_call(&side[1], &c);
        if (fuzz_traces)
            fprintf(stderr, "call %d odd %2d %g: a %d, b %d; %d granules, step %lld\n", c.kind, c.odd, c.value, a, b,
                    side[0].n, (long long)side[0].steps);
        if (a != b && left) break;                             /* side 0 has met the end of the step */
        /* a step that is taken up again counts its events anew */
        if (a == b && fails && a == GRANULATION_EVENTS) break;
        FUZZ_HOLDS(a == b && sim_may_answer(&c, a));
        if (a == GRANULATION_BAD_ARGUMENT || a == GRANULATION_BAD_DEF) FUZZ_HOLDS(sim_digest(&side[0]) == before);
        volumes_are_kept(&side[0]);
        if (left) FUZZ_HOLDS(granulation_sim_run(&side[0], 1) == granulation_sim_run(&side[1], 1));
        FUZZ_HOLDS(sim_digest(&side[0]) == sim_digest(&side[1]));
        FUZZ_HOLDS(memory[0].live_bytes <= 2000000); /* of 150 granules, and as many again by breakage */
        granulation_sim_mean(&side[0], 4, 3);
        if (a == GRANULATION_EVENTS || a == GRANULATION_POPULATION) break;
    }
    const uint64_t hash = sim_digest(&side[0]);
    for (int k = 0; k < 2; k++) {
        granulation_sim_free(&side[k]);
        FUZZ_HOLDS(failing_live(&memory[k]) == 0);
    }
    return hash;
}

/* ---- population balance, Monte Carlo ---- */

static double slow_breakage(const granulation_granule *g, const void *user) {
    return *(const double *)user * granulation_volume(g) / 1e-11;
}

static granulation_kernel kernel_of(int k) {
    static const granulation_kernel all[] = {
        granulation_constant_kernel,   granulation_sum_kernel,       granulation_product_kernel,
        granulation_shear_kernel,      granulation_eke_kernel,       granulation_brownian_kernel,
        granulation_kapur_kernel,      granulation_collision_kernel, granulation_cutoff_kernel,
        granulation_saturation_kernel, granulation_class_kernel};
    return all[k % (int)(sizeof all / sizeof *all)];
}

static void balance_is_whole(const granulation_balance *b) {
    const granulation_granule is = granulation_balance_totals(b);
    const double all = b->total.s + b->total.l + DBL_MIN; /* a cell's solid is what its liquid leaves of its key */
    near_to(is.s + b->lost.s, b->total.s, all), near_to(is.l + b->lost.l, b->total.l, all);
    for (int k = 0; k < b->n; k++) FUZZ_HOLDS(b->number[k] >= 0.0 && b->number[k] <= DBL_MAX);
    is_finite(b->time);
}

static uint64_t balance(fuzz_draws *d) {
    enum { CELLS = 14 };
    double edges[CELLS + 1], selection = 0.0;
    granulation_balance b;
    failing_allocator memory;
    granulation_balance_def def = granulation_balance_default_def();
    granulation_kernel_data data = granulation_default_kernel_data();
    const granulation_laws laws = granulation_default_laws();
    uint64_t hash = 0xcbf29ce484222325u;
    const call of = draw_call(d, 1);
    for (int k = 0; k <= CELLS; k++) edges[k] = 1e-13 * riddle_exp(0.5 * k);
    if (of.odd == 4) edges[of.pick % CELLS] = of.value;
    data.rate = decade(&of, 0, 1e-15, 1e-11), data.a = number(&of, 1, 0.0, 2.0), data.b = number(&of, 2, 0.0, 2.0),
    data.speed = number(&of, 3, 0.0, 3.0);
    data.laws = of.pick % 3 ? &laws : NULL, data.limit = of.pick % 5 ? HUGE_VAL : 2e-4;
    def.kernel = kernel_of(of.pick), def.kernel_user = of.pick % 7 ? &data : NULL,
    def.kernel_changes = of.pick / 16 % 2;
    def.scheme = (granulation_scheme)(of.pick / 32 % 2), def.daughters = (granulation_daughters)(of.pick / 64 % 3);
    const granulation_austin austin = {number(&of, 4, 0.0, 1.0), number(&of, 6, 0.5, 6.0), number(&of, 7, 0.5, 12.0)};
    def.breakage = of.pick % 11 ? granulation_austin_breakage : NULL, def.breakage_user = of.pick % 13 ? &austin : NULL;
    selection = number(&of, 5, 0.0, 1.0);
    def.selection = of.pick / 128 % 2 ? slow_breakage : NULL, def.selection_user = &selection;
    def.tolerance = decade(&of, 6, 1e-5, 1e-2), def.consolidation = number(&of, 7, 0.0, 0.1), def.most_steps = 300;
    failing_init(&memory);
    def.memory.fn = failing_fn, def.memory.user = &memory;
    if (fuzz_one_of(d, 8) == 0) memory.fail_at = fuzz_one_of(d, 8), memory.fail_count = 1;
    const int two = fuzz_one_of(d, 4) == 0;
    const granulation_status made =
        granulation_balance_init(&b, &def, CELLS, edges, NULL, two ? CELLS : 0, two ? edges : NULL, NULL);
    FUZZ_HOLDS(
        made == GRANULATION_OK || (made == GRANULATION_NO_MEMORY && memory.has_failed) ||
        ((made == GRANULATION_BAD_ARGUMENT || made == GRANULATION_BAD_DEF) && (of.odd >= 0 || two || !def.breakage)) ||
        made == GRANULATION_KERNEL);
    memory.fail_at = -1;
    for (int calls = 3 + fuzz_one_of(d, 8); calls > 0 && made == GRANULATION_OK; calls--) {
        const call c = draw_call(d, 3);
        const granulation_granule g = granule(&c);
        granulation_status status;
        if (c.kind == 0) {
            status = granulation_balance_add(&b, &g, decade(&c, 4, 1.0, 1e12));
            FUZZ_HOLDS(status == GRANULATION_OK || status == GRANULATION_BAD_ARGUMENT);
        } else if (c.kind == 1) {
            status = granulation_balance_run(&b, number(&c, 4, 0.0, 10.0));
            FUZZ_HOLDS(status == GRANULATION_OK || status == GRANULATION_BAD_ARGUMENT || status == GRANULATION_GEL ||
                       status == GRANULATION_STEP || status == GRANULATION_KERNEL);
        } else {
            def.tolerance = decade(&c, 4, 1e-5, 1e-2);
            status = granulation_balance_set(&b, &def);
            FUZZ_HOLDS(status == GRANULATION_OK || status == GRANULATION_BAD_DEF);
        }
        balance_is_whole(&b);
        fuzz_mix_bits(&hash, (uint64_t)status);
        for (int k = 0; k < b.n; k++) fuzz_mix_number(&hash, b.number[k]);
        granulation_balance_moment(&b, number(&c, 5, 0.0, 3.0), 0.0), granulation_balance_mean(&b, 4, 3);
    }
    granulation_balance_free(&b);
    FUZZ_HOLDS(failing_live(&memory) == 0);
    return hash;
}

static uint64_t monte_carlo(fuzz_draws *d) {
    enum { SAMPLE = 40 };
    granulation_granule sample[SAMPLE];
    granulation_montecarlo mc;
    granulation_kernel_data data = granulation_default_kernel_data();
    failing_allocator memory;
    granulation_memory hook = {failing_fn, &memory};
    uint64_t hash = 0xcbf29ce484222325u;
    const call of = draw_call(d, 1);
    for (int k = 0; k < SAMPLE; k++)
        sample[k].s = decade(&of, k % NUMBERS, 1e-13, 1e-11), sample[k].l = 0.3 * sample[k].s,
        sample[k].a = 0.1 * sample[k].s;
    data.rate = 1e-13, data.a = data.b = data.speed = 1.0;
    failing_init(&memory);
    if (fuzz_one_of(d, 8) == 0) memory.fail_at = fuzz_one_of(d, 3), memory.fail_count = 1;
    const granulation_status made = granulation_montecarlo_init(&mc, sample, SAMPLE, decade(&of, 4, 1e-12, 1e-9),
                                                                kernel_of(of.pick), &data, 7, &hook);
    FUZZ_HOLDS(made == GRANULATION_OK || made == GRANULATION_BAD_ARGUMENT || made == GRANULATION_KERNEL ||
               (made == GRANULATION_NO_MEMORY && memory.has_failed));
    memory.fail_at = -1;
    if (made == GRANULATION_OK) {
        const double pairs = 0.5 * SAMPLE * SAMPLE * mc.bound / mc.volume,
                     time = pairs > 0.0 ? 2e3 / pairs : 1.0; /* a few thousand draws */
        const granulation_status status = granulation_montecarlo_run(
            &mc, of.odd == 5 && !(of.value < 1e6 && of.value > 0.0) ? of.value : number(&of, 6, 0.0, time));
        FUZZ_HOLDS(status == GRANULATION_OK || status == GRANULATION_BAD_ARGUMENT || status == GRANULATION_KERNEL ||
                   status == GRANULATION_STEP);
        fuzz_mix_number(&hash, granulation_montecarlo_moment(&mc, 1.0)), fuzz_mix_number(&hash, mc.time);
    }
    granulation_montecarlo_free(&mc);
    FUZZ_HOLDS(failing_live(&memory) == 0);
    return hash;
}

static uint64_t run_program(fuzz_draws *d) {
    uint64_t hash = simulate(d);
    fuzz_mix_bits(&hash, balance(d));
    fuzz_mix_bits(&hash, monte_carlo(d));
    return hash;
}

FUZZ_PROGRAMS(200, 0, 3270, 6725, 7250)
