/* dem.h: what more cores can give, on a machine that has few.

   The host's `parallel` runs the tasks of a loop one after the other and times each. With as many cores as threads a
   run would take the time outside the loops, the longest task of each loop, and a time for waking in each loop. Nothing
   here shares a memory bus, so that the speedup is an upper bound. A scene runs several times from the same saved
   state; of each task, and of each time between two loops, the least counts, and the clock's own time is subtracted.
   Speedup is over the least work found with any number of threads.

   Beds: those of dem_beds, 20 000 and 100 000 spheres, at rest and vibrated, with friction; 1 million are
   the 20 000, 50 times along x. A sphere is where the file has it in memory, or its number is drawn at random
   (--shuffled). Beside the bound: what two real threads take, and as many as --asked on the processors that are here,
   with a pool of the host's. */
#include <pthread.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include "bed.h"
#include "common.h"
#include "dem.h"
#include "measure.h"

enum { COUNTS = 7, BEDS = 6, REPEATS_MAX = 25, PIECE = 10, FEATURES = DEM_LINEAR | DEM_FRICTION };
static const int counts[COUNTS] = {1, 2, 4, 8, 16, 32, 64};
static const int bed_spheres[BEDS] = {20000, 20000, 100000, 100000, 1000000, 1000000};
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

/* A scene when the clock starts: a saved world. */
typedef struct start {
    int spheres, vibrated, steps;
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

static int prepare(start *s, const char *folder, int shuffled, const program *self) {
    char message[1200];
    bed b;
    dem_world world;
    memset(&world, 0, sizeof world);
    if (bed_read(&b, folder, s->spheres, message, sizeof message) != 0) return common_fail("%s", message);
    if (shuffled) shuffle(&b, self->seed);
    dem_def def = bed_def(&b, 0.2, DEM_NAIVE);
    def.skin = 0.35;
    dem_status status = bed_world(&world, &b, &def, s->vibrated);
    bed_free(&b);
    if (status == DEM_OK) status = dem_run(&world, 100 * bed_dt, FEATURES);
    s->size = status == DEM_OK ? dem_save(&world, NULL, 0) : 0;
    s->bytes = malloc(s->size);
    if (!s->bytes && status == DEM_OK) status = DEM_OUT_OF_MEMORY;
    if (status == DEM_OK) dem_save(&world, s->bytes, s->size);
    dem_free(&world);
    return status == DEM_OK ? 0 : common_fail("%d spheres: %s", s->spheres, dem_status_text(status));
}

/* Runs a scene from its start with a host's threads. timed: NULL, or the path that `user` is. Returns seconds of
   the wall clock. */
static double run_scene(const start *s, int threads, void (*parallel)(void *, int, void (*)(void *, int), void *),
                        void *user, path *timed, dem_status *status) {
    dem_world world;
    double took = 0.0;
    if (*status != DEM_OK) return 0.0;
    *status = dem_load(&world, s->bytes, s->size, NULL);
    if (*status != DEM_OK) return 0.0;
    world.def.threads = threads, world.def.parallel = threads > 1 ? parallel : NULL, world.def.parallel_user = user;
    if (threads == 1) world.def.parallel = parallel;
    *status = dem_run(&world, 2 * PIECE * bed_dt, FEATURES); /* lists are made */
    if (timed) timed->at = timed->loops = 0;
    for (int done = 0; done < s->steps && *status == DEM_OK; done += PIECE) { /* cuts the time outside into pieces */
        const double began = machine_seconds();
        if (timed) timed->mark = began;
        *status = dem_run(&world, PIECE * bed_dt, FEATURES);
        if (timed) note(timed, machine_seconds() - timed->mark, 0);
        took += machine_seconds() - began;
    }
    dem_free(&world);
    return took;
}

static int find_bound(const start *s, int threads, int repeats, bound *b, progress *bar) {
    path p = {NULL, NULL, 0, 0, 0, 0, 0, price_of_clock(), 0.0};
    dem_status status = DEM_OK;
    for (; p.repeat < repeats && status == DEM_OK && !common_interrupted(); p.repeat++) {
        run_scene(s, threads, time_tasks, &p, &p, &status);
        progress_add(bar, 1.0 * s->steps * s->spheres);
    }
    *b = bound_of(&p, threads, s->steps);
    free(p.least), free(p.loop);
    if (p.failed) status = DEM_OUT_OF_MEMORY;
    return status == DEM_OK ? 0
                            : common_fail("%d spheres on %d threads: %s", s->spheres, threads, dem_status_text(status));
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

static int measure(row *r, int repeats, int asked, progress *bar) {
    for (int k = 0; k < COUNTS && !common_interrupted(); k++) {
        if (find_bound(&r->scene, counts[k], repeats, &r->of[k], bar) != 0) return -1;
    }
    r->one = r->two = r->many = (double)NAN;
    if (machine_cores() < 2) return 0;
    r->one = find_real(&r->scene, 1, repeats), r->two = find_real(&r->scene, 2, repeats),
    r->many = find_real(&r->scene, asked, repeats);
    return 0;
}

static double least_work(const row *r) {
    double least = HUGE_VAL;
    for (int k = 0; k < COUNTS; k++) least = fmin(least, r->of[k].work);
    return least;
}

static void report_row(const row *r, int asked, riddle_io_table *t, riddle_io_file *file, json *report) {
    const double one = least_work(r), each = 1e9 * one / r->scene.steps / r->scene.spheres;
    json_object_begin(report, NULL);
    json_integer(report, "spheres", r->scene.spheres);
    json_bool(report, "vibrated", r->scene.vibrated);
    json_number(report, "particle_step_ns", each);
    json_number(report, "two_threads_speedup", r->one / r->two);
    json_integer(report, "asked", asked);
    json_number(report, "asked_over_two", r->many / r->two);
    json_array_begin(report, "bounds");
    riddle_io_table_cell(t, "%d %s", r->scene.spheres, r->scene.vibrated ? "vibrated" : "at rest");
    riddle_io_table_cell(t, "%.0f", each);
    for (int k = 0; k < COUNTS; k++) {
        const bound *b = &r->of[k];
        csv_line(file, "%d,%d,%d,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", r->scene.spheres, r->scene.vibrated, b->threads,
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
        char name[80];
        snprintf(name, sizeof name, "%d %s", rows[r].scene.spheres, rows[r].scene.vibrated ? "vibrated" : "at rest");
        for (int k = 0; k < COUNTS; k++) threads[k] = counts[k], speedup[k] = least_work(&rows[r]) / rows[r].of[k].path;
        riddle_plot_line(figure, name, threads, speedup, COUNTS);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    }
    riddle_plot_write(figure, self->out, "dem_cores.svg");
}

int main(int argc, char **argv) {
    char found[1000];
    const char *folder = output_find(found, sizeof found, "tests/reference/beds");
    int most = 100000, steps = 100, repeats = 5, asked = 64, n = 0;
    bool shuffled = false;
    row rows[BEDS];
    double work_of_all = 0.0;
    option options[] = {
        option_string("beds", "DIR", &folder, "folder of the start files"),
        option_int("spheres", "N", &most, 2000, 1000000, "largest bed"),
        option_int("steps", "N", &steps, PIECE, 100000, "time steps of 20 000 spheres; 1 million take a fifth"),
        option_int("repeats", "N", &repeats, 1, REPEATS_MAX, "runs of each; the least times count"),
        option_int("asked", "N", &asked, 2, 64, "threads asked for on the processors that are here"),
        option_flag("shuffled", &shuffled, "spheres in memory in an order drawn at random"),
    };
    program self = program_start("dem_cores", "dem.h: a bound of the speedup by more cores than are here.", options,
                                 sizeof options / sizeof *options, argc, argv);
    if (self.quick && !is_given(&self, "spheres")) most = 2000;
    if (self.quick && !is_given(&self, "steps")) steps = PIECE;
    if (self.quick && !is_given(&self, "repeats")) repeats = 2;
    program_need_spheres(&self, "spheres", most);
    memset(rows, 0, sizeof rows);
    for (int k = 0; k < BEDS; k++) {
        const int spheres = most < 20000 ? 2000 : bed_spheres[k];
        if (spheres > most || (k > 1 && most < 20000)) continue;
        const int wanted = spheres > 100000 ? steps / 5 : steps;
        rows[n].scene.spheres = spheres, rows[n].scene.vibrated = k % 2;
        rows[n].scene.steps = wanted < PIECE ? PIECE : wanted / PIECE * PIECE;
        work_of_all += (double)COUNTS * repeats * rows[n].scene.steps * spheres;
        n++;
    }
    progress bar;
    progress_begin(&bar, "measuring", work_of_all);
    for (int k = 0; k < n && !common_interrupted(); k++) {
        if (prepare(&rows[k].scene, folder, shuffled, &self) != 0 || measure(&rows[k], repeats, asked, &bar) != 0)
            break;
        free(rows[k].scene.bytes);
        rows[k].scene.bytes = NULL;
    }
    progress_end(&bar);
    for (int k = 0; k < n; k++) free(rows[k].scene.bytes);
    if (common_exit_status() != 0) return common_exit_status();

    json *report = json_open(self.json);
    riddle_io_file *file =
        csv_open(self.out, "dem_cores.csv",
                 "spheres,vibrated,threads,work_s,outside_s,loops_a_step,speedup,speedup_with_waking,particle_step_ns");
    riddle_io_table t =
        riddle_io_table_begin("bed|ns a particle-step|2 threads|4|8|16|32|64|2 real threads|as many as asked over 2");
    json_array_begin(report, "beds");
    for (int k = 0; k < n; k++) report_row(&rows[k], asked, &t, file, report);
    json_array_end(report);
    table_end(&t);
    riddle_io_close(file);
    draw(&self, rows, n);
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
