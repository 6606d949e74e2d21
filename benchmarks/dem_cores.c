/* dem.h: what more cores can give, on a machine that has few.

   The host's `parallel` runs the tasks of a loop one after the other and times each. With as many cores as threads a
   run would take the time outside the loops, the longest task of each loop, and a time for waking in each loop. Nothing
   here shares a memory bus, so that the speedup is an upper bound. A scene runs several times from the same saved
   state; of each task, and of each time between two loops, the least counts, and the clock's own time is subtracted.
   Speedup is over the least work found with any number of threads.

   Beds: those of dem_beds, 20 000 and 100 000 spheres, at rest and vibrated, with friction; 1 million are
   the 20 000, 50 times along x. A sphere is where the file has it in memory, or its number is drawn at random
   (--shuffled). Other scenes, of 20 000 or so: the bed on a vibrating screen, dry and with liquid bridges; what of it
   fits into a drum of triangles that turns; bricks at rest. Beside the bound: what two real threads take, and as many
   as --asked on the processors that are here, with a pool of the host's. */
#include <pthread.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include "bed.h"
#include "brick_bed.h"
#include "common.h"
#include "dem.h"
#include "dem_wet.h"
#include "measure.h"

enum { COUNTS = 7, REPEATS_MAX = 25, PIECE = 10, FEATURES = DEM_LINEAR | DEM_FRICTION };
static const int counts[COUNTS] = {1, 2, 4, 8, 16, 32, 64};
static const double waking = 5e-6; /* [s] a loop, for the second bound */

/* ---- the bound ---- */

/* Times of a run in their order: outside, tasks of a loop, outside, tasks ... The same in each repeat. */
typedef struct path {
    double *least; /* [s] */
    long *loop;    /* number of the loop; 0: outside */
    long at, room, loops;
    int repeat, failed;
    double price, mark; /* of the clock; when the last task ended [s] */
} path;

static void note(path *p, double time, long loop) {
    if (p->at == p->room) {
        const long room = 2 * p->room + 4096;
        double *least = realloc(p->least, (size_t)room * sizeof *least);
        if (least) p->least = least;
        long *loops = least ? realloc(p->loop, (size_t)room * sizeof *loops) : NULL;
        if (!loops) {
            p->failed = 1;
            return;
        }
        p->loop = loops, p->room = room;
    }
    time = fmax(time - p->price, 0.0);
    p->least[p->at] = p->repeat == 0 ? time : fmin(time, p->least[p->at]);
    p->loop[p->at++] = loop;
}

/* A host's `parallel`; user: a path. */
static void time_tasks(void *user, int tasks, void (*task)(void *context, int index), void *context) {
    path *p = user;
    note(p, machine_seconds() - p->mark, 0);
    p->loops++;
    for (int k = 0; k < tasks; k++) {
        const double began = machine_seconds();
        task(context, k);
        note(p, machine_seconds() - began, p->loops);
    }
    p->mark = machine_seconds();
}

static double price_of_clock(void) {
    double least = 1.0;
    for (int k = 0; k < 10000; k++) {
        const double a = machine_seconds(), b = machine_seconds();
        least = fmin(least, b - a);
    }
    return least;
}

/* What a number of threads would take: work, share outside of loops, path, and path with waking [s]. */
typedef struct bound {
    int threads;
    double work, outside, path, woken, loops; /* loops: a step */
} bound;

static bound bound_of(const path *p, int threads, int steps) {
    bound b = {threads, 0.0, 0.0, 0.0, 0.0, (double)p->loops / steps};
    for (long k = 0; k < p->at;) {
        const long loop = p->loop[k];
        double most = 0.0;
        if (loop == 0) b.outside += p->least[k], b.work += p->least[k++];
        else {
            for (; k < p->at && p->loop[k] == loop; k++) b.work += p->least[k], most = fmax(most, p->least[k]);
            b.path += most;
        }
    }
    b.path += b.outside;
    b.woken = b.path + waking * (double)p->loops;
    return b;
}

/* ---- a pool of threads ---- */

/* Threads that wait for loops. They look for work for a while, and then sleep. */
typedef struct pool {
    pthread_t thread[64];
    pthread_mutex_t lock;
    pthread_cond_t begun, ended;
    int threads, tasks, next, left, round, stops;
    void (*task)(void *context, int index);
    void *context;
} pool;

/* Runs tasks of the present loop until none is left. The lock is held before and after. */
static void take_tasks(pool *p) {
    while (p->next < p->tasks) {
        const int k = p->next++;
        pthread_mutex_unlock(&p->lock);
        p->task(p->context, k);
        pthread_mutex_lock(&p->lock);
        if (--p->left == 0) pthread_cond_signal(&p->ended);
    }
}
static void *work(void *user) {
    pool *p = user;
    pthread_mutex_lock(&p->lock);
    for (int seen = 0; !p->stops;) {
        while (p->round == seen && !p->stops) pthread_cond_wait(&p->begun, &p->lock);
        seen = p->round;
        take_tasks(p);
    }
    pthread_mutex_unlock(&p->lock);
    return NULL;
}
static int pool_begin(pool *p, int threads) {
    memset(p, 0, sizeof *p);
    pthread_mutex_init(&p->lock, NULL);
    pthread_cond_init(&p->begun, NULL), pthread_cond_init(&p->ended, NULL);
    for (p->threads = 1; p->threads < threads; p->threads++) {
        if (pthread_create(&p->thread[p->threads], NULL, work, p) != 0) return -1;
    }
    return 0;
}
static void pool_end(pool *p) {
    pthread_mutex_lock(&p->lock);
    p->stops = 1;
    pthread_cond_broadcast(&p->begun);
    pthread_mutex_unlock(&p->lock);
    for (int k = 1; k < p->threads; k++) pthread_join(p->thread[k], NULL);
    pthread_mutex_destroy(&p->lock), pthread_cond_destroy(&p->begun), pthread_cond_destroy(&p->ended);
}
static void run_in_pool(void *user, int tasks, void (*task)(void *context, int index), void *context) {
    pool *p = user;
    pthread_mutex_lock(&p->lock);
    p->tasks = p->left = tasks, p->next = 0, p->task = task, p->context = context, p->round++;
    pthread_cond_broadcast(&p->begun);
    take_tasks(p);
    while (p->left > 0) pthread_cond_wait(&p->ended, &p->lock);
    pthread_mutex_unlock(&p->lock);
}

/* ---- scenes ---- */

typedef enum place { FLOOR, VIBRATED_FLOOR, DRY_SCREEN, WET_SCREEN, DRUM, BRICKS } place;

/* What is measured. */
typedef struct plan {
    const char *name;
    place where;
    int spheres; /* of the bed that it begins with */
} plan;
static const plan plans[] = {
    {"20 000 at rest", FLOOR, 20000},      {"20 000 vibrated", VIBRATED_FLOOR, 20000},
    {"100 000 at rest", FLOOR, 100000},    {"100 000 vibrated", VIBRATED_FLOOR, 100000},
    {"1 million at rest", FLOOR, 1000000}, {"1 million vibrated", VIBRATED_FLOOR, 1000000},
    {"dry screen", DRY_SCREEN, 20000},     {"wet screen", WET_SCREEN, 20000},
    {"drum of triangles", DRUM, 20000},    {"bricks at rest", BRICKS, 20000},
};
enum { SCENES = sizeof plans / sizeof *plans, BEDS = 6 };

/* A scene when the clock starts: a saved world. Liquid is not in the save: a wet scene begins with films and
   without contacts. */
typedef struct start {
    const plan *what;
    int bodies, steps, whole; /* steps of a run for the bound; of one for the wall clock */
    double dt;                /* [s] */
    double *diameters;        /* [bodies] [m] */
    int *group;               /* [bodies] */
    unsigned char *bytes;
    size_t size;
} start;

/* Draws a place in memory for every sphere. */
static void shuffle(bed *b, uint64_t seed) {
    for (int k = b->n - 1; k > 0; k--) {
        const int q = (int)(program_seed_of(seed, (uint64_t)k) % (uint64_t)(k + 1));
        for (int a = 0; a < 3; a++) {
            double *const arrays[] = {b->centres, b->velocities, b->spins};
            for (int m = 0; m < 3; m++) {
                const double t = arrays[m][3 * k + a];
                arrays[m][3 * k + a] = arrays[m][3 * q + a], arrays[m][3 * q + a] = t;
            }
        }
    }
}

/* A deck of square openings of 3 mm instead of the floor; the pattern repeats with the box. */
static dem_status lay_screen(dem_world *w, const bed *b, const dem_def *def) {
    const char *field;
    dem_screen screen = dem_default_screen();
    screen.aperture = 3e-3, screen.wire = 0.5e-3, screen.circular = 0;
    screen.half_x = screen.half_y = 25 * (screen.aperture + screen.wire);
    screen.centre = dem_vec3(0.5 * b->length_x, 0.5 * b->length_y, -0.5 * screen.wire);
    dem_status status = dem_init(w, def, &field);
    if (status != DEM_OK) return status;
    const int deck = dem_add_screen(w, 1, &screen);
    if (deck < 0) return (dem_status)-deck;
    status =
        dem_vibrate(w, deck, dem_vec3(0.0, 0.0, bed_amplitude), dem_vec3(0.0, 0.0, -0.5 * RIDDLE_PI), bed_frequency);
    return status == DEM_OK ? dem_add_spheres(w, b->n, b->centres, b->diameters, 0, 0) : status;
}

/* A tube of triangles about the y axis, in 64 strips, that turns once in 2 s. */
static dem_status add_drum(dem_world *w, double radius, double length) {
    enum { STRIPS = 64 };
    double vertex[6 * STRIPS];
    int32_t triangle[6 * STRIPS];
    dem_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    for (int k = 0; k < STRIPS; k++) {
        const double angle = 2.0 * RIDDLE_PI * k / STRIPS;
        const int32_t a = 2 * k, b = 2 * ((k + 1) % STRIPS);
        const int32_t pair[6] = {a, a + 1, b, b, a + 1, b + 1};
        for (int end = 0; end < 2; end++) {
            double *v = vertex + 3 * (2 * k + end);
            v[0] = radius * cos(angle), v[1] = (1.1 * end - 0.05) * length, v[2] = radius * sin(angle);
        }
        memcpy(triangle + 6 * k, pair, sizeof pair);
    }
    mesh.vertices = mesh.triangles = 2 * STRIPS, mesh.vertex = vertex, mesh.triangle = triangle;
    const int wall = dem_add_mesh(w, 1, &mesh);
    return wall < 0 ? (dem_status)-wall : dem_rotate(w, wall, dem_vec3(0, 0, 0), dem_vec3(0, 1, 0), RIDDLE_PI);
}

/* The spheres of three beds beside each other that lie within a drum, periodic along its axis. */
static dem_status fill_drum(dem_world *w, const bed *b, dem_def def) {
    const double radius = 0.1, free = radius * cos(RIDDLE_PI / 64) - 0.5 * bed_diameter;
    const char *field;
    def.periodic[0] = 0;
    dem_status status = dem_init(w, &def, &field);
    if (status == DEM_OK) status = add_drum(w, radius, b->length_y);
    for (int k = 0; k < 3 * b->n && status == DEM_OK; k++) {
        const double *c = b->centres + 3 * (k % b->n),
                     at[3] = {c[0] + (k / b->n - 1.5) * b->length_x, c[1], c[2] - radius};
        if (at[0] * at[0] + at[2] * at[2] < free * free) status = dem_add_spheres(w, 1, at, &bed_diameter, 0, 0);
    }
    return status;
}

/* 245 bricks that settle, 81 times beside each other. */
static dem_status lay_bricks(dem_world *w, const program *self) {
    enum { POURED = 5 * BRICKS_ACROSS * BRICKS_ACROSS };
    const double side = BRICKS_ACROSS * brick_spacing;
    int floor_wall;
    dem_status status = brick_box(w, side, &floor_wall);
    if (status == DEM_OK) status = brick_add_layers(w, 0, self->quick ? POURED / 5 : POURED, self->seed);
    if (status == DEM_OK) status = dem_run(w, self->quick ? 0.01 : 0.12, FEATURES);
    return status == DEM_OK ? brick_repeat(w, 0, self->quick ? 2 : 9, side, &floor_wall) : status;
}

static dem_status build(dem_world *w, place where, const bed *b, const dem_def *def, const program *self) {
    switch (where) {
    case DRY_SCREEN:
    case WET_SCREEN: return lay_screen(w, b, def);
    case DRUM: return fill_drum(w, b, *def);
    case BRICKS: return lay_bricks(w, self);
    default: return bed_world(w, b, def, where == VIBRATED_FLOOR);
    }
}

/* Films on all spheres of a world, 1 % of their mass. */
static dem_status moisten(const start *s, dem_world *w, wet_scene *scene) {
    const double class_diameter[WET_CLASSES] = {bed_diameter, bed_diameter, bed_diameter};
    const double mass = s->bodies * dem_mass(w, 0);
    w->user = scene;
    return wet_init(scene, s->bodies, s->group, s->diameters, class_diameter, 0.01, mass, 0, w, false, WET_STEEL) ==
                   BRIDGE_OK
               ? DEM_OK
               : DEM_BAD_ARGUMENT;
}

static dem_status run_for(const start *s, dem_world *w, int steps) {
    return s->what->where == WET_SCREEN ? wet_run(w, steps * s->dt, 0) : dem_run(w, steps * s->dt, FEATURES);
}

static int prepare(start *s, const char *folder, int shuffled, const program *self) {
    char message[1200];
    bed b;
    dem_world world;
    memset(&world, 0, sizeof world);
    if (bed_read(&b, folder, self->quick ? 2000 : s->what->spheres, message, sizeof message) != 0)
        return common_fail("%s", message);
    if (shuffled) shuffle(&b, self->seed);
    dem_def def = bed_def(&b, 0.2, DEM_NAIVE);
    def.skin = 0.35;
    dem_status status = build(&world, s->what->where, &b, &def, self);
    bed_free(&b);
    s->dt = world.def.dt, s->bodies = (int)world.count;
    if (status == DEM_OK && s->what->where != WET_SCREEN) status = dem_run(&world, 100 * s->dt, FEATURES);
    s->size = status == DEM_OK ? dem_save(&world, NULL, 0) : 0;
    s->bytes = malloc(s->size);
    s->diameters = malloc((size_t)s->bodies * sizeof *s->diameters);
    s->group = calloc((size_t)s->bodies, sizeof *s->group);
    if (status == DEM_OK && !(s->bytes && s->diameters && s->group)) status = DEM_OUT_OF_MEMORY;
    if (status == DEM_OK) dem_save(&world, s->bytes, s->size);
    for (int i = 0; i < s->bodies && status == DEM_OK; i++) s->diameters[i] = 2.0 * dem_radius(&world, i);
    dem_free(&world);
    return status == DEM_OK ? 0 : common_fail("%s: %s", s->what->name, dem_status_text(status));
}

static void start_free(start *s) {
    free(s->bytes), free(s->diameters), free(s->group);
    s->bytes = NULL, s->diameters = NULL, s->group = NULL;
}

/* Runs a scene from its start with a host's threads. timed: NULL, or the path that `user` is. Returns seconds of
   the wall clock. */
static double run_scene(const start *s, int threads, void (*parallel)(void *, int, void (*)(void *, int), void *),
                        void *user, path *timed, dem_status *status) {
    dem_world world;
    wet_scene liquid;
    double took = 0.0;
    memset(&liquid, 0, sizeof liquid);
    if (*status != DEM_OK) return 0.0;
    *status = dem_load(&world, s->bytes, s->size, NULL);
    if (*status != DEM_OK) return 0.0;
    world.def.threads = threads, world.def.parallel = threads > 1 ? parallel : NULL, world.def.parallel_user = user;
    if (threads == 1) world.def.parallel = parallel;
    if (s->what->where == WET_SCREEN) *status = moisten(s, &world, &liquid);
    if (*status == DEM_OK) *status = run_for(s, &world, 2 * PIECE); /* lists are made */
    if (timed) timed->at = timed->loops = 0;
    /* one thread has no loops whose times are noted: pieces cut its run */
    const int steps = timed ? s->steps : s->whole, piece = timed && threads == 1 ? PIECE : steps;
    for (int done = 0; done < steps && *status == DEM_OK; done += piece) {
        const double began = machine_seconds();
        if (timed) timed->mark = began;
        *status = run_for(s, &world, piece);
        if (timed) note(timed, machine_seconds() - timed->mark, 0);
        took += machine_seconds() - began;
    }
    dem_free(&world);
    wet_free(&liquid);
    return took;
}

static int find_bound(const start *s, int threads, int repeats, bound *b, progress *bar) {
    path p = {NULL, NULL, 0, 0, 0, 0, 0, price_of_clock(), 0.0};
    dem_status status = DEM_OK;
    for (; p.repeat < repeats && status == DEM_OK && !common_interrupted(); p.repeat++) {
        run_scene(s, threads, time_tasks, &p, &p, &status);
        progress_add(bar, 1.0 * s->steps * s->what->spheres);
    }
    *b = bound_of(&p, threads, s->steps);
    free(p.least), free(p.loop);
    if (p.failed) status = DEM_OUT_OF_MEMORY;
    return status == DEM_OK ? 0 : common_fail("%s, %d threads: %s", s->what->name, threads, dem_status_text(status));
}

/* The least time of several runs with a pool of threads [s]. */
static double find_real(const start *s, int threads, int repeats) {
    pool p;
    dem_status status = DEM_OK;
    double least = HUGE_VAL;
    if (pool_begin(&p, threads < machine_cores() ? threads : machine_cores()) != 0) return (double)NAN;
    for (int k = 0; k < repeats && !common_interrupted(); k++)
        least = fmin(least, run_scene(s, threads, run_in_pool, &p, NULL, &status));
    pool_end(&p);
    return status == DEM_OK ? least : (double)NAN;
}

/* ---- the program ---- */

typedef struct row {
    start scene;
    bound of[COUNTS];
    double one, two, many; /* real threads [s]; NaN without */
} row;

static int measure(row *r, int bounds, int repeats, int asked, progress *bar) {
    for (int k = 0; k < COUNTS && bounds && !common_interrupted(); k++) {
        if (find_bound(&r->scene, counts[k], repeats, &r->of[k], bar) != 0) return -1;
    }
    const int real = repeats < 3 ? repeats : 3;
    r->two = r->many = (double)NAN;
    r->one = find_real(&r->scene, 1, real);
    if (!bounds || machine_cores() < 2) return 0;
    r->two = find_real(&r->scene, 2, real), r->many = find_real(&r->scene, asked, real);
    return 0;
}

static double least_work(const row *r) {
    double least = HUGE_VAL;
    for (int k = 0; k < COUNTS; k++) least = fmin(least, r->of[k].work);
    return least;
}

static void report_row(const row *r, int asked, riddle_io_table *t, riddle_io_file *file, json *report) {
    const double one = least_work(r), each = one > 0.0 ? 1e9 * one / r->scene.steps / r->scene.bodies : (double)NAN,
                 whole = 1e9 * r->one / r->scene.whole / r->scene.bodies; /* one thread, one call of dem_run */
    json_object_begin(report, NULL);
    json_string(report, "scene", r->scene.what->name);
    json_integer(report, "bodies", r->scene.bodies);
    json_number(report, "particle_step_ns", each);
    json_number(report, "whole_run_ns", whole);
    json_number(report, "two_threads_speedup", r->one / r->two);
    json_integer(report, "asked", asked);
    json_number(report, "asked_over_two", r->many / r->two);
    json_array_begin(report, "bounds");
    riddle_io_table_cell(t, "%s", r->scene.what->name);
    riddle_io_table_cell(t, "%.0f", each);
    riddle_io_table_cell(t, "%.0f", whole);
    for (int k = 0; k < COUNTS; k++) {
        const bound *b = &r->of[k];
        csv_line(file, "%s,%d,%d,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", r->scene.what->name, r->scene.bodies, b->threads,
                 b->work, b->outside, b->loops, one / b->path, one / b->woken, each);
        json_object_begin(report, NULL);
        json_integer(report, "threads", b->threads);
        json_number(report, "speedup", one / b->path);
        json_number(report, "speedup_with_waking", one / b->woken);
        json_number(report, "outside_share", b->outside / one);
        json_number(report, "loops_a_step", b->loops);
        json_object_end(report);
        if (k > 0) riddle_io_table_cell(t, "%.2f (%.2f)", one / b->path, one / b->woken);
    }
    json_array_end(report);
    json_object_end(report);
    riddle_io_table_cell(t, "%.2f", r->one / r->two);
    riddle_io_table_cell(t, "%.2f", r->many / r->two);
}

static void draw(const program *self, const row *rows, int n) {
    riddle_plot *figure = riddle_plot_new("Speedup, a bound without waking and shared memory", 1, 1);
    double threads[COUNTS], speedup[COUNTS];
    riddle_plot_panel(figure, 0, 0, "threads [-]", "speedup [-]");
    riddle_plot_log_x(figure);
    for (int r = 0; r < n; r++) {
        for (int k = 0; k < COUNTS; k++) threads[k] = counts[k], speedup[k] = least_work(&rows[r]) / rows[r].of[k].path;
        riddle_plot_line(figure, rows[r].scene.what->name, threads, speedup, COUNTS);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    }
    riddle_plot_write(figure, self->out, "dem_cores.svg");
}

int main(int argc, char **argv) {
    char found[1000];
    const char *folder = output_find(found, sizeof found, "tests/reference/beds");
    int most = 100000, steps = 100, repeats = 5, asked = 64, others = 0, bounds = 0, n = 0;
    bool shuffled = false;
    row rows[SCENES];
    double work_of_all = 0.0;
    option options[] = {
        option_string("beds", "DIR", &folder, "folder of the start files"),
        option_choice("scenes", &others, "all|beds|others", "which are measured"),
        option_int("spheres", "N", &most, 20000, 1000000, "largest bed"),
        option_int("steps", "N", &steps, PIECE, 100000, "time steps of 20 000 spheres; 1 million take a fifth"),
        option_int("repeats", "N", &repeats, 1, REPEATS_MAX, "runs of each; the least times count"),
        option_int("asked", "N", &asked, 2, 64, "threads asked for on the processors that are here"),
        option_choice("bounds", &bounds, "yes|no", "no: one thread alone is timed, without pieces"),
        option_flag("shuffled", &shuffled, "spheres in memory in an order drawn at random"),
    };
    program self = program_start("dem_cores", "dem.h: a bound of the speedup by more cores than are here.", options,
                                 sizeof options / sizeof *options, argc, argv);
    if (self.quick && !is_given(&self, "spheres")) most = 20000;
    if (self.quick && !is_given(&self, "steps")) steps = PIECE;
    if (self.quick && !is_given(&self, "repeats")) repeats = 2;
    program_need_spheres(&self, "spheres", most);
    memset(rows, 0, sizeof rows);
    for (int k = 0; k < SCENES; k++) {
        if (plans[k].spheres > most || others == (k < BEDS ? 2 : 1)) continue;
        const int wanted = plans[k].spheres > 100000 ? steps / 5 : steps;
        rows[n].scene.what = &plans[k];
        rows[n].scene.steps = wanted < PIECE ? PIECE : wanted / PIECE * PIECE, rows[n].scene.whole = steps;
        work_of_all += (double)COUNTS * repeats * rows[n].scene.steps * plans[k].spheres;
        n++;
    }
    progress bar;
    progress_begin(&bar, "measuring", work_of_all);
    for (int k = 0; k < n && !common_interrupted(); k++) {
        if (prepare(&rows[k].scene, folder, shuffled, &self) != 0 ||
            measure(&rows[k], bounds == 0, repeats, asked, &bar) != 0)
            break;
        start_free(&rows[k].scene);
    }
    progress_end(&bar);
    for (int k = 0; k < n; k++) start_free(&rows[k].scene);
    if (common_exit_status() != 0) return common_exit_status();

    json *report = json_open(self.json);
    riddle_io_file *file =
        csv_open(self.out, "dem_cores.csv",
                 "scene,bodies,threads,work_s,outside_s,loops_a_step,speedup,speedup_with_waking,particle_step_ns");
    riddle_io_table t = riddle_io_table_begin(
        "scene|ns a particle-step|in one run|2 threads|4|8|16|32|64|2 real threads|as many as asked over 2");
    json_array_begin(report, "scenes");
    for (int k = 0; k < n; k++) report_row(&rows[k], asked, &t, file, report);
    json_array_end(report);
    table_end(&t);
    riddle_io_close(file);
    if (bounds == 0) draw(&self, rows, n);
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
