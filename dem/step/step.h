/* A step, and a run of steps. Reads and writes everything through the parts below it. Promises: after a failure the
   world can be read, saved and freed. */
#pragma once
#include "../removal/remove.h"
#include "../contacts/forces.h"
#include "spatial_sort.h"
#include "../ledger/ledger.h"
#include "integrate.h"
#include "detect.h"
#include "../particles/active.h"

/* Tests all pairs and walls once, even those that are skipped. Timers stay as they are: the functions called here set
   none if def.skip is 0. */
static inline void dem__test_everything(dem_world *w) {
    int skip = w->def.skip;
    w->def.skip = 0;
    dem__test_all_pairs(w, w->step);
    DEM__TELL(w, detect, (w, w->step));
    for (ptrdiff_t i = 0; i < w->count; i++) {
        for (int k = 0; k < w->walls; k++) {
            if (dem__has_surface(&w->wall[k]) && dem__needs_test(w, i, k))
                dem__test_wall(w, (int32_t)i * w->walls + k, w->step);
        }
    }
    w->def.skip = skip;
}

/* Ends the contacts that changes by the caller have ended, and rebuilds the list of near pairs. Returns 0 after a
   failure. */
static inline int dem__prepare_lists(dem_world *w) {
    const dem__contacts *contacts = &w->engine->contacts;
    if (!w->engine->run.needs_lists) return 1;
    DEM__EACH_CONTACT(w, c) {
        if (dem__is_taken_away(w, contacts->i[c], contacts->j[c])) contacts->ended[c] = 1;
    }
    dem__remove_ended(w, w->step, 1);
    if (!dem__rebuild(w)) return 0;
    int going = 1;
    DEM__ASK(w, going, prepare_run, (w));
    return going || dem__fail_to_list(w, w->status);
}

/* Computes the damping ratios of all pairs of materials, and whether all were set. */
static inline void dem__prepare_pairs(dem_world *w) {
    w->engine->run.has_unset_pairs = 0;
    for (int a = 0; a < w->def.materials; a++) {
        for (int b = a; b < w->def.materials; b++) {
            const dem_pair_def *pair = &w->def.pair[a][b];
            double(*ratio)[DEM_MATERIALS_MAX] = w->engine->run.damping_ratio;
            w->engine->run.has_unset_pairs |= a != b && !pair->given;
            ratio[a][b] = ratio[b][a] = dem_damping_ratio(pair->restitution, pair->mode);
        }
    }
}

/* Tests everything and begins the contacts found, whose slots are then listed. Returns how many, or -1 after a
   failure. */
static inline ptrdiff_t dem__begin_contacts_present(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__test_everything(w);
    if (w->engine->run.has_unset_pairs && w->status == DEM_OK) dem__check_pairs_set(w);
    if (w->status != DEM_OK) {
        dem__undo_detection(w);
        return -1;
    }
    const ptrdiff_t begun = contacts->begun;
    dem__commit_begun(w, 0.0);
    DEM__TELL(w, contacts_begun, (w, begun));
    dem__list_active(w);
    for (ptrdiff_t k = 0; k < begun; k++) {
        const int32_t c = contacts->slots[k], i = contacts->i[c], j = contacts->j[c];
        if (j < 0 && !dem__has_elements(&w->wall[-1 - j]))
            dem__stop_timer(&w->engine->walls.timers, i * w->walls - 1 - j);
    }
    return begun;
}

/* Sets law and features of the run. If they have changed, computes the constants of all contacts again. */
static inline void dem__set_law(dem_world *w, const dem_law *law, int features) {
    dem__run *run = &w->engine->run;
    if (run->needs_forces || run->features != features || run->law != law) {
        w->engine->contacts.type_count = 0;
        run->stiffest = 0.0;
        DEM__EACH_CONTACT(w, c) { dem__set_constants(w, c, law, features); }
    }
    run->features = features;
    run->law = law;
}

/* Computes all forces while no time passes, and from them the accelerations. Returns 0 after a failure. */
static inline int dem__find_forces(dem_world *w, const dem_kernel *kernel, ptrdiff_t begun) {
    dem__report_begun(w, kernel->law, begun);
    dem__advance(w, 0.0); /* before anything that may run out of memory, so that a world that fails there can be
                             saved */
    if (!dem__reorder_contacts(w)) return 0;
    DEM__TELL(w, find_forces, (w));
    dem__evaluate(w, kernel->loop, 0.0, w->engine->run.has_friction, 1);
    DEM__TELL(w, forces_found, (w));
    DEM__TELL(w, add_forces, (w, 0.0));
    if (!dem__kick(w, 0.0)) return dem__fail(w, DEM_NOT_FINITE);
    dem__kick_walls(w, 0.0);
    dem__remove_ended(w, w->step, 0);
    dem__check_bounds(w);
    int going = w->status == DEM_OK;
    DEM__ASK(w, going, begin_flights, (w));
    return going;
}

/* Begins a run: lists, contacts that are already present, their forces and the accelerations. Returns 0 after a
   failure. */
static DEM__NOINLINE int dem__prepare_run(dem_world *w, const dem_kernel *kernel, int features) {
    dem__run *run = &w->engine->run;
    run->power = features & DEM_HERTZ ? 2.5 : 2.0; /* what begins before the first step needs both */
    run->has_friction = (features & DEM_FRICTION) != 0;
    if (!dem__prepare_lists(w)) return 0;
    for (int k = 0; k < w->walls; k++) dem__move_wall(&w->wall[k], w->time);
    run->turns = 1; /* for the first step: an earlier run may have left spin rates */
    w->engine->bodies.adds_loads = w->engine->bodies.loads_on;
    for (int k = 0; k < w->engine->features; k++) w->engine->bodies.adds_loads |= w->engine->feature[k].adds_loads;
    dem__prepare_pairs(w);
    const ptrdiff_t begun = run->needs_forces ? dem__begin_contacts_present(w) : 0;
    if (begun < 0) return 0;
    dem__set_law(w, kernel->law, features);
    DEM__TELL(w, set_law, (w, kernel));
    if (run->needs_forces && !dem__find_forces(w, kernel, begun)) return 0;
    run->needs_forces = 0;
    DEM__TELL(w, begin_run, (w));
    return 1;
}

/* Finds the contacts that begin in a step, with the walls at its end. Returns 0 after a failure. */
static inline int dem__find_contacts_that_begin(dem_world *w) {
    if (!dem__move_walls(w, w->step + 1)) w->status = DEM_NOT_FINITE;
    else dem__detect(w, w->step + 1);
    if (w->engine->run.has_unset_pairs && w->status == DEM_OK) dem__check_pairs_set(w);
    return w->status == DEM_OK;
}

/* Computes the constants of the contacts that begin, and calls the law's hook. */
static inline void dem__prepare_begun(dem_world *w, const dem_law *law, ptrdiff_t begun, int features) {
    for (ptrdiff_t k = 0; k < begun; k++) dem__set_constants(w, w->engine->contacts.slots[k], law, features);
    dem__report_begun(w, law, begun);
}

static inline void dem__count_step(dem_world *w) {
    const dem__run *run = &w->engine->run;
    w->particle_steps += w->count - w->engine->bodies.dropped;
    w->contact_steps += w->engine->contacts.count;
    w->step++;
    w->time = run->start_time + (double)(w->step - run->start_step) * run->dt;
}

/* Returns whether the energies of the particles that leave in this step are finite. Nothing checks their velocities
   later. */
static DEM__NOINLINE int dem__leave_with_numbers(dem_world *w) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i] != DEM_LEAVING) continue;
        if (dem__finite(dem__motion_energy(w, i) + dem__potential(w, i))) continue;
        w->failed_id = w->id[i];
        return 0;
    }
    return 1;
}

/* Removes particles that passed an exit from the lists, and marks their contacts as ended. Returns whether there are
   any. */
static inline int dem__remove_leaving(dem_world *w) {
    dem__contacts *contacts = &w->engine->contacts;
    if (!w->engine->run.leaving) return 0;
    DEM__EACH_CONTACT(w, c) {
        const ptrdiff_t j = contacts->j[c];
        if (w->alive[contacts->i[c]] == DEM_LEAVING || (j >= 0 && w->alive[j] == DEM_LEAVING)) contacts->ended[c] = 1;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i] == DEM_LEAVING) dem__detach_one(w, i); /* those of a rigid body are all marked */
    }
    dem__number_present(w);
    w->engine->run.leaving = 0;
    return 1;
}

/* Advances the world by one step. keep: stores the forces of contacts for readers. Returns 0 after a failure. */
static inline int dem__step(dem_world *w, const dem_kernel *kernel, int keep) {
    const int features = w->engine->run.features, has_friction = w->engine->run.has_friction;
    const double h = w->engine->run.dt;
    int going = 1;
    if (w->step % DEM__REORDER_STEPS == 0 && !dem__reorder_contacts(w)) return 0;
    if (w->step >= w->engine->pairs.next_check && !dem__check_list(w)) return 0;
    DEM__ASK(w, going, begin_step, (w));
    if (!going) return 0;
    if (!dem__find_contacts_that_begin(w)) return dem__undo_detection(w);
    const ptrdiff_t begun = w->engine->contacts.begun;
    dem__commit_begun(w, 1.0);
    DEM__TELL(w, contacts_begun, (w, begun));
    dem__advance(w, h);
    dem__prepare_begun(w, kernel->law, begun, features);
    dem__evaluate(w, kernel->loop, h, has_friction, keep);
    DEM__TELL(w, add_forces, (w, h));
    const int finite = dem__kick(w, h);
    dem__kick_walls(w, h);
    dem__apply_corrections(w, has_friction);
    dem__count_step(w);
    if (!finite || (w->engine->run.leaving && !dem__leave_with_numbers(w))) return dem__fail(w, DEM_NOT_FINITE);
    if (w->engine->run.leaving) DEM__TELL(w, leave, (w));
    const int leaving = dem__remove_leaving(w);
    dem__remove_ended(w, w->step, leaving);
    if (leaving) dem__free_untouched(w);
    dem__check_bounds(w);
    going = w->status == DEM_OK;
    DEM__ASK(w, going, begin_flights, (w));
    DEM__ASK(w, going, end_step, (w));
    return going;
}

/* Returns whether a kernel computes friction that this run leaves out. Its history then stays zero. */
static inline int dem__has_void_history(const dem_kernel *kernel, int features) {
    return (kernel->features & ~features & DEM_FRICTION) != 0;
}

/* Returns whether a law can take over the present contacts. They continue under a law with as many states of the same
   meaning. A history that is zero means nothing, and can be dropped or begun. */
static inline int dem__takes_over(const dem_world *w, const dem_kernel *kernel, int features) {
    const dem__contacts *contacts = &w->engine->contacts;
    if (contacts->count == 0) return 1;
    if (kernel->law->states == contacts->states)
        return !contacts->has_history || dem__is_of_law(contacts->law, kernel->law);
    return !contacts->has_history && (kernel->law->states == 0 || dem__has_void_history(kernel, features));
}

/* Returns what prevents a run, or DEM_OK. */
static inline dem_status dem__check_run(const dem_world *w, const dem_kernel *kernel, int features) {
    if (!dem__is_thread_count(w->def.threads)) return DEM_BAD_DEFINITION;
    if (w->status == DEM_NOT_FINITE || w->status == DEM_TOO_FAST) return w->status;
    for (int k = 0; k < w->walls; k++) {
        if (w->wall[k].asked.drive == DEM_PRESCRIBED && !w->wall[k].asked.motion) return DEM_NO_MOTION;
    }
    dem_status status = DEM_OK;
    DEM__CHECK(w, status, check_run, (w, kernel));
    if (status != DEM_OK) return status;
    const double narrowest = dem__narrowest(w);
    /* spheres that have been listed fit */
    for (ptrdiff_t i = 0; i < w->count && narrowest < HUGE_VAL && w->engine->run.needs_lists; i++) {
        if (w->alive[i] && !(narrowest > 4.4 * w->particle[i].radius)) return DEM_BAD_DEFINITION;
    }
    if (!dem__takes_over(w, kernel, features)) return DEM_LAW_MISMATCH;
    return DEM_OK;
}

/* Gives contacts the arrays that law, ledger and threads need. Returns 0 when out of memory; then nothing has
   changed. */
static inline int dem__fit_contact_arrays(dem_world *w, const dem_kernel *kernel, int features) {
    const dem_law *law = kernel->law;
    dem__contacts *contacts = &w->engine->contacts;
    const int states = contacts->states, constants = contacts->constants;
    const int postpones = dem__may_postpone(w) && !contacts->postponed;
    const int books = (features & DEM_ENERGY) && !w->engine->ledger.on;
    dem__array list[DEM__ARRAYS_MAX];
    if (law->states == states && law->constants <= constants && !books && !postpones) return 1;
    if (books) kernel->add_ledger(w);
    contacts->states = law->states;
    contacts->constants = law->constants > constants ? law->constants : constants;
    if (!dem__grow_group(w, list, dem__contact_arrays(w, list), &contacts->block, &contacts->bytes, &contacts->capacity,
                         dem__next_slot(w) + 1)) {
        contacts->states = states, contacts->constants = constants;
        if (books) dem__drop_feature(w, DEM__LEDGER_FEATURE);
        return 0;
    }
    w->engine->ledger.on |= books;
    for (int a = contacts->states; a < DEM_STATE_MAX; a++) contacts->state[a] = NULL; /* not part of the block */
    return 1;
}

/* Returns the time step over the largest stable one: 2 sqrt(m/k) for a spring, whose contact lasts pi sqrt(m/k), and 2
   m/gamma for a dashpot. */
static inline double dem__step_ratio(const dem_world *w, int features) {
    const dem_advice a = dem_advise(w, features, 1.0);
    const double spring = features & DEM_HERTZ ? a.rayleigh : a.contact * (2.0 / RIDDLE_PI);
    const double dashpot = features & DEM_HERTZ ? HUGE_VAL : 2.0 * a.dashpot,
                 least = spring < dashpot ? spring : dashpot;
    return least < HUGE_VAL ? w->engine->run.dt / least : 0.0;
}

/* Runs a kernel with some of its features. The law's prepare function leaves out friction and rolling that are not
   among them. */
static inline dem_status dem__run_kernel(dem_world *world, double duration, const dem_kernel *kernel, int features) {
    dem_world *w = world;
    if (dem__lacks_memory(w)) return DEM_BAD_ARGUMENT;
    if (!kernel || !kernel->loop || !dem__is_law(kernel->law) || !kernel->law->prepare ||
        ((features & DEM_ENERGY) && !kernel->add_ledger))
        return dem__refuse(w, "kernel: NULL, without a loop or its ledger, or of a law without functions or with too "
                              "many states or constants");
    if (!dem__not_negative(duration)) return dem__refuse(w, "duration: below 0 or not finite");
    if (dem__is_running(w)) return DEM_BUSY;
    const double dt = w->engine->run.dt, owed = w->owed + duration, remaining = owed / dt;
    if (!(remaining < 9e15)) return dem__refuse(w, "duration: 9e15 steps or more");
    const dem_status status = dem__check_run(w, kernel, features);
    if (status != DEM_OK) return status;
    w->status = DEM_OK; /* the caller may have repaired any other failure */
    if (!dem__make_work(w) || !dem__fit_contact_arrays(w, kernel, features)) return DEM_OUT_OF_MEMORY;
    w->engine->contacts.has_history = kernel->law->states > 0 && !dem__has_void_history(kernel, features);
    w->engine->contacts.law = dem__law_mark(kernel->law);
    const int64_t steps = remaining > 0.0 ? (int64_t)floor(remaining + 0.5) : 0;
    w->owed = 0.0; /* if the run fails */
    if (w->step_ratio == 0.0 || w->engine->run.needs_lists) w->step_ratio = dem__step_ratio(w, features);
    w->engine->run.running = 1;
    int going = dem__prepare_run(w, kernel, features);
    if (going) dem__order_memory(w, kernel, steps);
    for (int64_t n = steps; n > 0 && going; n--) {
        going = dem__step(w, kernel, n == 1);
        if (w->step % DEM__RANK_STEPS == 1 && going) dem__order_memory(w, kernel, n - 1); /* ranks are new */
    }
    dem__lie_by_number(w);
    DEM__GET(w, going, end_run, (w, going));
    w->engine->run.running = 0;
    const double met = 0.5 * sqrt(w->engine->run.stiffest); /* the stiffest contact that has begun */
    if (met > w->step_ratio) w->step_ratio = met;
    if (!going) return w->status;
    w->owed = owed - (double)steps * dt;
    return DEM_OK;
}

DEM_API dem_status dem_run_law(dem_world *world, double duration, const dem_kernel *kernel) {
    return dem__run_kernel(world, duration, kernel, kernel ? kernel->features : 0);
}

/* name, version, states, history, vectors, constants, prepare, force, born, ended */
static const dem_law dem_law_linear = {"linear",         1,    0,   0, 0, DEM_LINEAR_CONSTANTS, dem_prepare_linear,
                                       dem_force_linear, NULL, NULL};
static const dem_law dem_law_linear_friction = {
    "linear, friction", 1, 3, 3, 1, DEM_LINEAR_CONSTANTS, dem_prepare_linear, dem_force_linear_friction, NULL, NULL};
static const dem_law dem_law_linear_rolling = {
    "linear, friction, rolling", 1,    3,   3, 1, DEM_LINEAR_CONSTANTS, dem_prepare_linear,
    dem_force_linear_rolling,    NULL, NULL};
static const dem_law dem_law_hertz = {"Hertz",         1,    0,   0, 0, DEM_HERTZ_CONSTANTS, dem_prepare_hertz,
                                      dem_force_hertz, NULL, NULL};
static const dem_law dem_law_hertz_friction = {
    "Hertz-Mindlin", 1, 4, 4, 1, DEM_HERTZ_CONSTANTS, dem_prepare_hertz, dem_force_hertz_friction, NULL, NULL};
static const dem_law dem_law_hertz_rolling = {
    "Hertz-Mindlin, rolling", 1, 4, 4, 1, DEM_HERTZ_CONSTANTS, dem_prepare_hertz, dem_force_hertz_rolling, NULL, NULL};

DEM__KERNEL_OF(dem__kernel_linear, dem_law_linear, DEM_LINEAR)
DEM__KERNEL_OF(dem__kernel_linear_friction, dem_law_linear_friction, DEM_LINEAR | DEM_FRICTION)
DEM__KERNEL_OF(dem__kernel_linear_rolling, dem_law_linear_rolling, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING)
DEM__KERNEL_OF(dem__kernel_linear_energy, dem_law_linear_rolling, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY)
DEM__KERNEL_OF(dem__kernel_hertz, dem_law_hertz, DEM_HERTZ)
DEM__KERNEL_OF(dem__kernel_hertz_friction, dem_law_hertz_friction, DEM_HERTZ | DEM_FRICTION)
DEM__KERNEL_OF(dem__kernel_hertz_rolling, dem_law_hertz_rolling, DEM_HERTZ | DEM_FRICTION | DEM_ROLLING)
DEM__KERNEL_OF(dem__kernel_hertz_energy, dem_law_hertz_rolling, DEM_HERTZ | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY)

/* The kernel for features that a shipped law has. Kernels with a ledger always compute friction and rolling; features
   that the caller did not name have constants of zero. */
#define DEM__KERNEL_FOR(features)                                                                                      \
    ((features)&DEM_ENERGY ? ((features)&DEM_HERTZ ? dem__kernel_hertz_energy() : dem__kernel_linear_energy())         \
                           : ((features)&DEM_HERTZ ? ((features)&DEM_ROLLING    ? dem__kernel_hertz_rolling()          \
                                                      : (features)&DEM_FRICTION ? dem__kernel_hertz_friction()         \
                                                                                : dem__kernel_hertz())                 \
                                                   : ((features)&DEM_ROLLING    ? dem__kernel_linear_rolling()         \
                                                      : (features)&DEM_FRICTION ? dem__kernel_linear_friction()        \
                                                                                : dem__kernel_linear())))

static inline dem_status dem__run_shipped(dem_world *world, double duration, const dem_kernel *kernel, int features) {
    switch (features & ~DEM_ENERGY) {
    case DEM_LINEAR:
    case DEM_LINEAR | DEM_FRICTION:
    case DEM_LINEAR | DEM_FRICTION | DEM_ROLLING:
    case DEM_HERTZ:
    case DEM_HERTZ | DEM_FRICTION:
    case DEM_HERTZ | DEM_FRICTION | DEM_ROLLING: return dem__run_kernel(world, duration, kernel, features);
    default:
        return dem__refuse(world, "features: no shipped law has these: DEM_LINEAR or DEM_HERTZ, DEM_ROLLING only with "
                                  "DEM_FRICTION");
    }
}

DEM__CHOICE dem_status dem_run(dem_world *world, double duration, int features) {
    return dem__run_shipped(world, duration, DEM__KERNEL_FOR(features), features);
}
/* Compilers optimise every function that is named before they find out which constants reach it. Where features are
   written as a constant, this macro leaves them only one kernel to look at: an eighth of the compile time. */
#ifdef __GNUC__
#define dem_run(world, duration, features)                                                                             \
    (__builtin_constant_p(features) ? dem__run_shipped(world, duration, DEM__KERNEL_FOR(features), features)           \
                                    : (dem_run)(world, duration, features))
#endif
