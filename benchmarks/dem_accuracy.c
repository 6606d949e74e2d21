/* dem.h: error against run time.

   1. Impacts of two equal spheres, head-on and oblique with friction, over all phases of the first step: how far the
      velocities after the impact are from the exact ones. Coefficients of restitution 0.78 and 0.4351, both
      conventions, steps from t_c/8 to t_c/400.
   2. A stack of ten spheres, damped or elastic, that falls on a floor: where they are after 40 ms, against an
      integrator that finds every beginning and end of a contact (Runge-Kutta 4 between them). Each impact multiplies an
      error; by 50 ms no step in this range is small enough.
   3. Layers of skipping on the stack: run time, same hash.

   dem.h is compared with the integrators of other codes, in impact.h: they apply a whole step's force or none in the
   first and last step of a contact. Effort is counted in evaluations of the contact law, those of resolved steps
   included; run time is processor time. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "dem.h"
#include "impact.h"

enum { LEVELS = 8, PHASES_MAX = 1000, SPHERES = 10, STACK_PHASES = 16 };
static const int divisions[LEVELS] = {8, 12, 20, 35, 60, 100, 200, 400}; /* steps per contact time */

/* ---- the pair law with a counter, and the same without resolved steps ---- */

DEM_INLINE void counted_force(const dem_contact *c, double *state, dem_response *r) {
    evaluations++;
    dem_law_linear_friction.force(c, state, r);
}
static const dem_law counted_law = {"linear, counted", 1, 3, 3, 1, 8, dem_prepare_linear, counted_force, NULL, NULL};
DEM_KERNEL(counted_kernel, counted_law, DEM_LINEAR | DEM_FRICTION)

DEM_INLINE void counted_unresolved_force(const dem_contact *c, double *state, dem_response *r) {
    evaluations++;
    unresolved_force(c, state, r);
}
static const dem_law counted_unresolved_law = {"counted, unresolved",    1,    3,   3, 1, 8, unresolved_prepare,
                                               counted_unresolved_force, NULL, NULL};
DEM_KERNEL(counted_unresolved_kernel, counted_unresolved_law, DEM_LINEAR | DEM_FRICTION)

/* Classical, for head-on impacts only: a Coulomb slider has no derivative. */
static void runge_kutta(const pair_law *law, pair_state *s, pair_rate *a, double dt) {
    const double weight[4] = {1.0, 2.0, 2.0, 1.0}, reach[4] = {0.0, 0.5, 0.5, 1.0};
    pair_state sum = *s, at = *s;
    double v = 0.0, f = 0.0;
    for (int k = 0; k < 4; k++) {
        at.x = s->x + reach[k] * dt * v, at.vx = s->vx + reach[k] * dt * f;
        pair_force(law, &at, 0.0, a);
        v = at.vx, f = a->x;
        sum.x += dt / 6.0 * weight[k] * v, sum.vx += dt / 6.0 * weight[k] * f;
    }
    *s = sum;
}

/* ---- 1: impacts ---- */

enum { DEM, UNRESOLVED, VERLET, LEAPFROG, RUNGE_KUTTA, METHODS };
static const int colours[METHODS] = {0, 4, 1, 2, 3};
static const char *const method_names[METHODS] = {"dem.h", "dem.h without its correction", "predicted Verlet",
                                                  "leapfrog (LAMMPS, YADE)", "Runge-Kutta 4"};

typedef struct outcome {
    double effort, cpu_ns; /* evaluations and processor time per impact; NaN where not measured */
    double bias, rms, most;
} outcome;

/* Error of a state after the impact: head-on in v'/v; oblique the length of the error of velocity and surface speed of
   spin, over v. */
static double miss(const impact *of, const pair_state *s, const pair_state *exact) {
    if (of->angle == 0.0) return s->vx / speed - of->restitution;
    const double x = s->vx - exact->vx, y = s->vy - exact->vy, w = 0.5 * diameter * (s->spin - exact->spin);
    return sqrt(x * x + y * y + w * w) / speed;
}

static void collect(outcome *o, double error, int phases) {
    o->bias += error / phases;
    o->rms += error * error / phases;
    o->most = fmax(o->most, fabs(error));
}

static void others(const impact *of, int method, int division, int phases, const pair_state *exact, outcome *o) {
    const pair_law law = law_of(of);
    const double dt = contact_time_of(of) / division;
    memset(o, 0, sizeof *o);
    long spent = 0;
    for (int p = 0; p < phases; p++) {
        pair_state s = approach(of, dt * (1.0 + (p + 0.5) / phases));
        pair_rate a = {0.0, 0.0, 0.0, 0.0};
        for (int n = 0; n < 3 * division; n++) {
            const double before = overlap_of(&s);
            evaluations = 0;
            if (method == VERLET) predicted_verlet(&law, &s, &a, dt);
            else if (method == LEAPFROG) leapfrog(&law, &s, &a, dt);
            else runge_kutta(&law, &s, &a, dt);
            if (before > 0.0 || overlap_of(&s) > 0.0) spent += evaluations; /* others look, too, but need no law */
        }
        collect(o, miss(of, &s, exact), phases);
    }
    o->rms = sqrt(o->rms);
    o->effort = (double)spent / phases;
    o->cpu_ns = (double)NAN;
}

static double processor_ns(dem_world *w, double duration, const dem_kernel *kernel, dem_status *status) {
    const double start = machine_processor_seconds();
    *status = kernel ? dem_run_law(w, duration, kernel) : dem_run(w, duration, DEM_LINEAR | DEM_FRICTION);
    return 1e9 * (machine_processor_seconds() - start);
}

static double middle_of(double *v, int n) {
    for (int i = 1; i < n; i++)
        for (int k = i; k > 0 && v[k - 1] > v[k]; k--) {
            double swap = v[k];
            v[k] = v[k - 1], v[k - 1] = swap;
        }
    return v[n / 2];
}

/* dem.h as shipped, without its correction, and both with a counter. */
enum { VARIANTS = 4 };
static const dem_kernel *const kernels[VARIANTS] = {NULL, &unresolved_kernel, &counted_kernel,
                                                    &counted_unresolved_kernel};

static int own(const impact *of, int division, int phases, const pair_state *exact, outcome *shipped,
               outcome *unresolved) {
    enum { REPEATS = 5 };
    outcome *const outcomes[2] = {shipped, unresolved};
    double ns[VARIANTS][REPEATS];
    const double duration = 3.0 * contact_time_of(of);
    for (int k = 0; k < 2; k++) memset(outcomes[k], 0, sizeof(outcome));
    for (int repeat = 0; repeat < REPEATS; repeat++) {
        for (int variant = 0; variant < (repeat ? 2 : VARIANTS); variant++) {
            dem_world w;
            outcome *o = outcomes[variant % 2];
            dem_status status = world_of_pairs(&w, of, division, phases);
            evaluations = 0;
            if (status == DEM_OK) ns[variant][repeat] = processor_ns(&w, duration, kernels[variant], &status);
            if (variant >= 2) o->effort = (double)evaluations / phases;
            for (int p = 0; p < phases && variant < 2 && repeat == 0 && status == DEM_OK; p++) {
                const dem_vec a = dem_velocity(&w, 2 * p), b = dem_velocity(&w, 2 * p + 1);
                pair_state s = {0.0, 0.0, a.x - b.x, a.y - b.y, dem_spin(&w, 2 * p).z, 0.0};
                collect(o, miss(of, &s, exact), phases);
            }
            dem_free(&w);
            if (status != DEM_OK) return common_fail("impact: %s", dem_status_text(status));
        }
    }
    for (int k = 0; k < 2; k++) {
        outcomes[k]->rms = sqrt(outcomes[k]->rms);
        outcomes[k]->cpu_ns = middle_of(ns[k], REPEATS) / phases;
    }
    return 0;
}

static const char *mode_name(dem_restitution mode) { return mode == DEM_CLIPPED ? "clipped" : "naive"; }

static void record(result_table *runs, const char *scene, const impact *of, const char *method, int division,
                   const outcome *o) {
    results_row(runs, TEXTS(scene, mode_name(of->mode), method), of->restitution, division, o->effort, o->cpu_ns,
                o->bias, o->rms, o->most);
}

static void impacts(const program *self, result_table *runs, json *report, riddle_plot *figure, progress *bar) {
    const double restitutions[2] = {0.78, 0.4351}, angles[3] = {0.0, RIDDLE_PI / 6.0, RIDDLE_PI / 3.0};
    const char *const scenes[3] = {"head-on", "oblique 30 deg", "oblique 60 deg"};
    const int phases = self->quick ? 50 : PHASES_MAX;
    double x[LEVELS], summary[2][2][METHODS] = {{{0.0}}}, by_mode[2][2][2][LEVELS], steps[LEVELS];
    static const result_column columns[] = {{NULL, "impact", "%s"},
                                            {NULL, "convention", "%s"},
                                            {NULL, "e", "%g"},
                                            {NULL, "t_c/dt", "%.0f"},
                                            {NULL, "dem.h: evaluations", "%.1f"},
                                            {NULL, "bias", "%.1e"},
                                            {NULL, "rms", "%.1e"},
                                            {NULL, "predicted Verlet: rms", "%.1e"},
                                            {NULL, "leapfrog: rms", "%.1e"},
                                            {NULL, "us an impact", "%.2f", 1e-3},
                                            {NULL, "us, without correction", "%.2f", 1e-3}};
    result_table *t = RESULTS(columns);
    for (int k = 0; k < 3; k++) {
        for (int r = 0; r < 2; r++) {
            for (int mode = 0; mode < 2; mode++) {
                impact of = {restitutions[r], angles[k], mode ? DEM_NAIVE : DEM_CLIPPED};
                const pair_state exact = exact_outcome(&of);
                outcome o[METHODS][LEVELS];
                const int methods = k == 0 ? METHODS : METHODS - 1;
                for (int level = 0; level < LEVELS && !common_interrupted(); level++) {
                    if (own(&of, divisions[level], phases, &exact, &o[DEM][level], &o[UNRESOLVED][level]) != 0) return;
                    for (int m = VERLET; m < methods; m++)
                        others(&of, m, divisions[level], phases, &exact, &o[m][level]);
                    for (int m = DEM; m < methods; m++)
                        record(runs, scenes[k], &of, method_names[m], divisions[level], &o[m][level]);
                    steps[level] = divisions[level];
                    if (k == 0)
                        by_mode[0][mode][r][level] = o[DEM][level].rms,
                        by_mode[1][mode][r][level] = o[VERLET][level].rms;
                    if (divisions[level] == 20 || divisions[level] == 100) {
                        const outcome *d = &o[DEM][level];
                        results_row(t, TEXTS(scenes[k], mode_name(of.mode)), of.restitution, divisions[level],
                                    d->effort, d->bias, d->rms, o[VERLET][level].rms, o[LEAPFROG][level].rms, d->cpu_ns,
                                    o[UNRESOLVED][level].cpu_ns);
                    }
                    progress_add(bar, 1.0);
                }
                if (common_interrupted()) return;
                if (k == 0)
                    for (int m = DEM; m < METHODS; m++) summary[mode][r][m] = o[m][2].rms;
                if (r == 0 && mode == 0 && k < 2) { /* e = 0.78, clipped */
                    riddle_plot_panel(
                        figure, 0, k,
                        k ? "evaluations of the contact law per impact" : "processor time per impact [\xc2\xb5s]",
                        k ? "rms error of velocity and spin, over v [-]" : "rms error of restitution [-]");
                    riddle_plot_title(figure, k ? "Oblique impact, 30\xc2\xb0, friction"
                                                : "Head-on impact, e = 0.78: run time");
                    riddle_plot_log_x(figure);
                    riddle_plot_log_y(figure);
                    for (int m = DEM; m < methods; m++) {
                        double y[LEVELS];
                        if (k == 0 ? m > UNRESOLVED : m == UNRESOLVED) continue;
                        for (int level = 0; level < LEVELS; level++) {
                            x[level] = k ? o[m][level].effort : 1e-3 * o[m][level].cpu_ns;
                            y[level] = o[m][level].rms;
                        }
                        riddle_plot_line(figure, method_names[m], x, y, LEVELS);
                        riddle_plot_style(figure, RIDDLE_PLOT_MARKED, colours[m]);
                    }
                }
            }
        }
    }
    results_print(t);
    results_free(t);
    common_print("\n");
    riddle_plot_panel(figure, 1, 1, "steps per contact time", "rms error of restitution [-]");
    riddle_plot_title(figure, "Head-on: convention and e");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    for (int r = 0; r < 2; r++) {
        for (int mode = 0; mode < 2; mode++) {
            char label[60];
            snprintf(label, sizeof label, "e = %g, %s", restitutions[r], mode ? "naive" : "clipped");
            riddle_plot_line(figure, label, steps, by_mode[0][mode][r], LEVELS);
            riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
            riddle_plot_line(figure, NULL, steps, by_mode[1][mode][r], LEVELS);
            riddle_plot_style(figure, RIDDLE_PLOT_DASHED, RIDDLE_PLOT_SAME);
        }
    }
    riddle_plot_text_share(figure, 0.03, 0.06, "dashed: predicted Verlet");
    json_object_begin(report, "restitution_rms_at_tc_20");
    for (int m = DEM; m < METHODS; m++) json_number(report, method_names[m], summary[0][0][m]);
    json_object_end(report);
    const double order = log(by_mode[0][0][0][5] / by_mode[0][0][0][7]) / log((double)divisions[7] / divisions[5]);
    json_number(report, "order_of_dem_clipped_078", order);
    common_print("head-on, e = 0.78, clipped: rms error at t_c/20 %.1e, predicted Verlet %.1e; observed order of dem.h "
                 "%.2f (t_c/100 .. "
                 "t_c/400)\n\n",
                 summary[0][0][DEM], summary[0][0][VERLET], order);
}

/* ---- 2: a stack ---- */

/* Spheres above each other over a floor, in one dimension. Contact k is between spheres k-1 and k; contact 0
   with the floor. */
typedef struct stack {
    double z[SPHERES], v[SPHERES];
} stack;

typedef struct stack_law {
    double mass, k, gamma_floor, gamma_pair;
    int clipped;
} stack_law;

static const double stack_time = 0.04, gravity = 9.81;

static stack_law stack_law_of(double restitution, dem_restitution mode) {
    stack_law law;
    const double zeta = dem_damping_ratio(restitution, mode);
    law.mass = RIDDLE_PI / 6.0 * diameter * diameter * diameter * density;
    law.k = stiffness;
    law.gamma_floor = 2.0 * zeta * sqrt(law.k * law.mass);
    law.gamma_pair = 2.0 * zeta * sqrt(law.k * 0.5 * law.mass);
    law.clipped = mode == DEM_CLIPPED;
    return law;
}

/* Gaps of about a tenth of a diameter, the lowest 5 mm over the floor; `shift` moves the phase of the first step. */
static stack stack_start(double shift) {
    stack s;
    double z = 0.5 * diameter + 0.005 + shift;
    for (int i = 0; i < SPHERES; i++) {
        s.z[i] = z;
        s.v[i] = 0.0;
        z += diameter * (1.08 + 0.01 * (i * 7 % 5));
    }
    return s;
}

static double stack_gap(const stack *s, int k) {
    return k ? s->z[k] - s->z[k - 1] - diameter : s->z[0] - 0.5 * diameter;
}

/* The force that contact k has while it is in contact. */
static double stack_raw(const stack_law *law, const stack *s, int k) {
    const double opening = k ? s->v[k] - s->v[k - 1] : s->v[0];
    return -law->k * stack_gap(s, k) - (k ? law->gamma_pair : law->gamma_floor) * opening;
}

static int stack_touches(const stack_law *law, const stack *s, int k) {
    return stack_gap(s, k) < 0.0 && (!law->clipped || stack_raw(law, s, k) > 0.0);
}

/* Accelerations; touching NULL: as the state has it. */
static void stack_accelerate(const stack_law *law, const stack *s, const int *touching, double *a) {
    for (int i = 0; i < SPHERES; i++) a[i] = -gravity;
    for (int k = 0; k < SPHERES; k++) {
        if (touching ? !touching[k] : !(stack_gap(s, k) < 0.0)) continue;
        double force = stack_raw(law, s, k);
        evaluations++;
        if (!touching && law->clipped && force < 0.0) force = 0.0;
        a[k] += force / law->mass;
        if (k) a[k - 1] -= force / law->mass;
    }
}

static stack stack_step(const stack_law *law, const stack *s, const int *touching, double dt) {
    const double weight[4] = {1.0, 2.0, 2.0, 1.0}, reach[4] = {0.0, 0.5, 0.5, 1.0};
    stack sum = *s, at = *s;
    double v[SPHERES] = {0.0}, a[SPHERES] = {0.0};
    for (int k = 0; k < 4; k++) {
        for (int i = 0; i < SPHERES; i++)
            at.z[i] = s->z[i] + reach[k] * dt * v[i], at.v[i] = s->v[i] + reach[k] * dt * a[i];
        stack_accelerate(law, &at, touching, a);
        for (int i = 0; i < SPHERES; i++) {
            v[i] = at.v[i];
            sum.z[i] += dt / 6.0 * weight[k] * v[i], sum.v[i] += dt / 6.0 * weight[k] * a[i];
        }
    }
    return sum;
}

static int stack_changed(const stack_law *law, const stack *s, const int *touching) {
    for (int k = 0; k < SPHERES; k++)
        if (stack_touches(law, s, k) != touching[k]) return 1;
    return 0;
}

/* Runge-Kutta 4, cut at every beginning and end of a contact. */
static stack stack_exact(const stack_law *law, stack s, double dt) {
    int touching[SPHERES] = {0};
    for (double t = 0.0; t < stack_time;) {
        double h = fmin(dt, stack_time - t);
        stack next = stack_step(law, &s, touching, h);
        if (stack_changed(law, &next, touching)) {
            double low = 0.0, high = h;
            for (int k = 0; k < 50; k++) {
                const double middle = 0.5 * (low + high);
                next = stack_step(law, &s, touching, middle);
                if (stack_changed(law, &next, touching)) high = middle;
                else low = middle;
            }
            h = high;
            next = stack_step(law, &s, touching, h);
        }
        s = next;
        t += h;
        for (int k = 0; k < SPHERES; k++) touching[k] = stack_touches(law, &s, k);
    }
    return s;
}

static stack stack_others(const stack_law *law, stack s, int method, double dt, int steps) {
    double a[SPHERES], b[SPHERES];
    for (int i = 0; i < SPHERES; i++) a[i] = -gravity;
    if (method == LEAPFROG)
        for (int i = 0; i < SPHERES; i++) s.v[i] += 0.5 * dt * a[i];
    for (int n = 0; n < steps; n++) {
        if (method == VERLET) {
            stack at;
            for (int i = 0; i < SPHERES; i++)
                at.z[i] = s.z[i] += dt * (s.v[i] + 0.5 * dt * a[i]), at.v[i] = s.v[i] + dt * a[i];
            stack_accelerate(law, &at, NULL, b);
            for (int i = 0; i < SPHERES; i++) s.v[i] += 0.5 * dt * (a[i] + b[i]), a[i] = b[i];
        } else if (method == LEAPFROG) {
            for (int i = 0; i < SPHERES; i++) s.z[i] += dt * s.v[i];
            stack_accelerate(law, &s, NULL, a);
            for (int i = 0; i < SPHERES; i++) s.v[i] += dt * a[i];
        } else {
            s = stack_step(law, &s, NULL, dt);
        }
    }
    return s;
}

static dem_status world_of_stack(dem_world *w, const stack *s, double restitution, dem_restitution mode, double dt,
                                 int skip) {
    dem_def def = dem_default_def();
    const int glass = dem_add_material(&def, density, 5e10, 0.2);
    double centres[3 * SPHERES], diameters[SPHERES];
    dem_pair_def *pair = dem_pair(&def, glass, glass);
    pair->stiffness = stiffness;
    pair->restitution = restitution;
    pair->mode = mode;
    pair->friction = 0.0;
    def.gravity = dem_vec3(0.0, 0.0, -gravity);
    def.dt = dt;
    def.skip = skip;
    dem_status status = dem_init(w, &def, NULL);
    if (status != DEM_OK) return status;
    for (int i = 0; i < SPHERES; i++) {
        centres[3 * i] = centres[3 * i + 1] = 0.0;
        centres[3 * i + 2] = s->z[i];
        diameters[i] = diameter;
    }
    const int floor_wall = dem_add_plane(w, glass, dem_vec3(0.0, 0.0, 0.0), dem_vec3(0.0, 0.0, 1.0));
    if (floor_wall < 0) return (dem_status)-floor_wall;
    return dem_add_spheres(w, SPHERES, centres, diameters, glass, 0);
}

/* rms over the spheres of the error of their heights [diameters] */
static double stack_error(const double *z, const stack *exact) {
    double sum = 0.0;
    for (int i = 0; i < SPHERES; i++) sum += (z[i] - exact->z[i]) * (z[i] - exact->z[i]) / SPHERES;
    return sqrt(sum) / diameter;
}

static void stacks(const program *self, result_table *runs, riddle_plot *figure, progress *bar) {
    const double restitutions[3] = {0.78, 0.4351, 1.0};
    const int phases = self->quick ? 2 : STACK_PHASES;
    static const result_column columns[] = {{NULL, "stack", "%s"},
                                            {NULL, "convention", "%s"},
                                            {NULL, "e", "%g"},
                                            {NULL, "t_c/dt", "%.0f"},
                                            {NULL, "dem.h: evaluations", "%.0f"},
                                            {NULL, "rms error [d]", "%.1e"},
                                            {NULL, "predicted Verlet: rms", "%.1e"},
                                            {NULL, "leapfrog: rms", "%.1e"},
                                            {NULL, "us a run", "%.0f", 1e-3},
                                            {NULL, "us, without correction", "%.0f", 1e-3},
                                            {NULL, "ledger", "%.1e"}};
    result_table *t = RESULTS(columns);
    for (int r = 0; r < 3; r++) {
        /* without a dashpot both conventions are one */
        for (int mode = 0; mode < (restitutions[r] < 1.0 ? 2 : 1); mode++) {
            const stack_law law = stack_law_of(restitutions[r], mode ? DEM_NAIVE : DEM_CLIPPED);
            const double zeta = dem_damping_ratio(restitutions[r], mode ? DEM_NAIVE : DEM_CLIPPED);
            const double contact_time =
                dem_contact_time(stiffness, 0.5 * law.mass, zeta, mode ? DEM_NAIVE : DEM_CLIPPED);
            const impact as = {restitutions[r], 0.0, mode ? DEM_NAIVE : DEM_CLIPPED};
            stack starts[STACK_PHASES], exact[STACK_PHASES];
            for (int p = 0; p < phases; p++) { /* a step at t_c/8 falls 0.013 mm here: phases over all of it */
                starts[p] = stack_start(1.3e-5 * (p + 0.5) / phases);
                exact[p] = stack_exact(&law, starts[p], contact_time / 100.0);
            }
            outcome o[METHODS][LEVELS];
            memset(o, 0, sizeof o);
            for (int level = 0; level < LEVELS && !common_interrupted(); level++) {
                const int steps = (int)ceil(stack_time / (contact_time / divisions[level]));
                const double dt = stack_time / steps;
                double worst_ledger = 0.0, ns[2][STACK_PHASES];
                for (int p = 0; p < phases; p++) {
                    for (int m = VERLET; m < METHODS; m++) {
                        evaluations = 0;
                        const stack s = stack_others(&law, starts[p], m, dt, steps);
                        o[m][level].effort += (double)evaluations / phases;
                        collect(&o[m][level], stack_error(s.z, &exact[p]), phases);
                    }
                    for (int variant = 0; variant <= VARIANTS; variant++) { /* the last with a ledger */
                        dem_world w;
                        dem_status status = world_of_stack(&w, &starts[p], restitutions[r], as.mode, dt, DEM_SKIP_ALL);
                        evaluations = 0;
                        if (status == DEM_OK && variant < VARIANTS) {
                            const double spent = processor_ns(&w, stack_time, kernels[variant], &status);
                            if (variant < 2) ns[variant][p] = spent;
                            else o[variant - 2][level].effort += (double)evaluations / phases;
                        } else if (status == DEM_OK) {
                            status = dem_run(&w, stack_time, DEM_LINEAR | DEM_ENERGY);
                            const dem_energy_ledger l = dem_energy(&w);
                            worst_ledger = fmax(worst_ledger, fabs(l.error) / (fabs(l.wall_work) + l.released +
                                                                               l.start - l.start_potential));
                        }
                        if (variant < 2 && status == DEM_OK) {
                            double z[SPHERES];
                            for (int i = 0; i < SPHERES; i++) z[i] = dem_position(&w, i).z;
                            collect(&o[variant][level], stack_error(z, &exact[p]), phases);
                        }
                        dem_free(&w);
                        if (status != DEM_OK) {
                            common_fail("stack: %s", dem_status_text(status));
                            return;
                        }
                    }
                }
                for (int m = DEM; m < METHODS; m++) o[m][level].rms = sqrt(o[m][level].rms);
                for (int m = DEM; m < METHODS; m++)
                    o[m][level].cpu_ns = m <= UNRESOLVED ? middle_of(ns[m], phases) : (double)NAN;
                for (int m = DEM; m < METHODS; m++)
                    record(runs, "stack", &as, method_names[m], divisions[level], &o[m][level]);
                if (divisions[level] == 20 || divisions[level] == 100) {
                    results_row(t, TEXTS("10 spheres", mode_name(as.mode)), restitutions[r], divisions[level],
                                o[DEM][level].effort, o[DEM][level].rms, o[VERLET][level].rms, o[LEAPFROG][level].rms,
                                o[DEM][level].cpu_ns, o[UNRESOLVED][level].cpu_ns, worst_ledger);
                }
                progress_add(bar, 2.0);
            }
            if (r == 0 && mode == 0 && !common_interrupted()) {
                riddle_plot_panel(figure, 1, 0, "evaluations of the contact law", "rms error of height / diameter [-]");
                riddle_plot_title(figure, "Ten spheres fall on a floor, 40 ms");
                riddle_plot_log_x(figure);
                riddle_plot_log_y(figure);
                for (int m = DEM; m < METHODS; m++) {
                    double x[LEVELS], y[LEVELS];
                    if (m == UNRESOLVED) continue;
                    for (int level = 0; level < LEVELS; level++)
                        x[level] = o[m][level].effort, y[level] = o[m][level].rms;
                    riddle_plot_line(figure, method_names[m], x, y, LEVELS);
                    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, colours[m]);
                }
            }
        }
    }
    results_print(t);
    results_free(t);
    common_print("\n");
}

/* ---- 3: layers of skipping ---- */

static void layers(json *report) {
    enum { REPEATS = 9 };
    const char *const names[4] = {"nothing", "pairs", "space", "pairs and space"};
    const int skips[4] = {0, DEM_SKIP_PAIRS, DEM_SKIP_SPACE, DEM_SKIP_ALL};
    const stack start = stack_start(0.0);
    uint64_t hash[4];
    static const result_column columns[] = {{"skip", "the stack, t_c/20, skipping", "%s"},
                                            {"processor_ns", "us a run", "%.0f", 1e-3},
                                            {"looks_per_particle_step", "looks a particle-step", "%.4f"},
                                            {NULL, "hash", "%s"},
                                            {"same_hash", NULL, "yes|no"}};
    result_table *t = RESULTS(columns);
    for (int k = 0; k < 4; k++) {
        double ns[REPEATS], looks = 0.0;
        for (int repeat = 0; repeat < REPEATS; repeat++) {
            dem_world w;
            dem_status status = world_of_stack(&w, &start, 0.78, DEM_CLIPPED, 4.5e-6, skips[k]);
            if (status == DEM_OK) ns[repeat] = processor_ns(&w, stack_time, NULL, &status);
            hash[k] = dem_hash(&w);
            looks = (double)w.looks / (double)w.particle_steps;
            dem_free(&w);
            if (status != DEM_OK) {
                common_fail("stack: %s", dem_status_text(status));
                return;
            }
        }
        char text[20];
        snprintf(text, sizeof text, "%016llx", (unsigned long long)hash[k]);
        results_row(t, TEXTS(names[k], text), middle_of(ns, REPEATS), looks, hash[k] == hash[0]);
        if (hash[k] != hash[0]) common_fail("skipping %s changes the result", names[k]);
    }
    results_print(t);
    results_json(t, report, "skipping");
    results_free(t);
}

int main(int argc, char **argv) {
    program self = program_start("dem_accuracy",
                                 "dem.h: error against run time on impacts and a stack; plain integrators beside it.",
                                 NULL, 0, argc, argv);
    json *report = json_open(self.json);
    static const result_column columns[] = {
        {"scene", NULL, "%s"}, {"restitution"}, {"convention", NULL, "%s"}, {"integrator", NULL, "%s"},
        {"steps_per_contact"}, {"evaluations"}, {"processor_ns"},           {"error_bias"},
        {"error_rms"},         {"error_max"}};
    result_table *runs = RESULTS(columns);
    riddle_plot *figure = riddle_plot_new("dem.h: error against effort", 2, 2);
    progress bar;
    progress_begin(&bar, "accuracy", LEVELS * (12.0 + 10.0));
    stacks(&self, runs, figure, &bar);
    if (!common_interrupted()) impacts(&self, runs, report, figure, &bar);
    progress_end(&bar);
    if (!common_interrupted()) {
        results_json(runs, report, "runs");
        layers(report);
        results_csv(runs, self.out, "dem_accuracy.csv");
        riddle_plot_write(figure, self.out, "dem_accuracy.svg");
        json_bool(report, "deterministic_build", dem_build_is_deterministic() != 0);
        json_program(report, &self);
        json_close(report);
    }
    results_free(runs);
    return common_exit_status();
}
