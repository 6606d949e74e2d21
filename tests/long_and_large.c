/* Long and large runs of dem.h, for scripts/verify long_and_large: 1e8 steps of a few spheres over a vibrating floor,
   the same steps beyond 2^31 and 2^32, and 2 million spheres at rest. Each must end as it should, without drift, in the
   memory that the manual of dem.h states.
   Usage: long_and_large [STEPS] [SPHERES]. Prints what it found; exit status 1 if anything is not as it should be. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "dem.h"

static int failures;
static void expect(int holds, const char *what) {
    if (!holds) printf("FAILED: %s\n", what), failures++;
}

/* ---- memory that is counted ---- */

typedef struct counted {
    size_t live, peak;
} counted;
static void *count_bytes(void *user, void *old, size_t old_size, size_t new_size) {
    counted *c = (counted *)user;
    c->live += new_size - old_size;
    c->peak = c->live > c->peak ? c->live : c->peak;
    if (new_size > 0) return realloc(old, new_size);
    free(old);
    return NULL;
}

static dem_def definition(counted *memory) {
    dem_def def = dem_default_def();
    const int glass = dem_add_material(&def, 2500.0, 5e7, 0.2);
    dem_pair_def *pair = dem_pair(&def, glass, glass);
    pair->stiffness = 1000.0, pair->restitution = 0.8, pair->friction = 0.3;
    def.dt = 1e-5;
    def.allocator.fn = count_bytes, def.allocator.user = memory;
    return def;
}

/* ---- long ---- */

enum { FEW = 3 };
static const double shake[] = {1e-4, 50.0}; /* amplitude [m], frequency [Hz] */

/* Spheres of 2, 3 and 4 mm above a floor that vibrates, far from each other. Steps are counted from `step` on. */
static void few_spheres(dem_world *w, counted *memory, int64_t step) {
    const double at[3 * FEW] = {0, 0, 3e-3, 0.02, 0, 4e-3, 0, 0.02, 5e-3}, d[FEW] = {2e-3, 3e-3, 4e-3};
    const dem_def def = definition(memory);
    expect(dem_init(w, &def, NULL) == DEM_OK, "init");
    w->step = w->engine->run.start_step = step;
    const int floor = dem_add_plane(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
    expect(dem_vibrate(w, floor, dem_vec3(0, 0, shake[0]), dem_vec3(0, 0, 0), shake[1]) == DEM_OK, "vibrate");
    expect(dem_add_spheres(w, FEW, at, d, 0, 0) == DEM_OK, "add");
}

/* Mean of the spheres' heights, over parts of a run. */
static double mean_height(dem_world *w, int64_t steps, int features) {
    enum { PARTS = 2000 };
    double sum = 0.0;
    for (int k = 0; k < PARTS; k++) {
        expect(dem_run(w, (double)(steps / PARTS) * w->def.dt, features) == DEM_OK, "run");
        for (int i = 0; i < FEW; i++) sum += dem_position(w, i).z / (FEW * PARTS);
    }
    return sum;
}

static void run_long(int64_t steps) {
    const int features = DEM_LINEAR | DEM_FRICTION | DEM_ENERGY;
    counted memory = {0, 0};
    dem_world w;
    const clock_t begin = clock();
    few_spheres(&w, &memory, 0);
    mean_height(&w, steps / 20 / 2000 * 2000, features);
    const size_t early = memory.live;
    const dem_energy_ledger start = dem_energy(&w);
    const double first = mean_height(&w, (steps - w.step) / 2 / 2000 * 2000, features);
    const double second = mean_height(&w, (steps - w.step) / 2000 * 2000, features);
    const dem_energy_ledger end = dem_energy(&w);
    const double moved = end.wall_work - start.wall_work, error = (end.error - start.error) / moved;
    double aside = 0.0;
    for (int i = 0; i < FEW; i++) {
        const dem_vec x = dem_position(&w, i), v = dem_velocity(&w, i), s = dem_spin(&w, i);
        aside += fabs(x.x - (i == 1 ? 0.02 : 0.0)) + fabs(x.y - (i == 2 ? 0.02 : 0.0)) + fabs(v.x) + fabs(v.y) +
                 dem__length(s);
    }
    printf("%lld steps, %.0f s: mean height %.6f and %.6f mm in the two halves; %.3g J by the floor, error %.1e of it; "
           "%.1f s of processor "
           "time\n",
           (long long)w.step, w.time, 1e3 * first, 1e3 * second, moved, error,
           (double)(clock() - begin) / CLOCKS_PER_SEC);
    expect(w.step == steps, "number of steps");
    expect(fabs(w.time - (double)steps * w.def.dt) <= 1e-15 * w.time, "time is that of the steps");
    expect(aside == 0.0, "what moves up and down moves nowhere else");
    expect(fabs(first - second) < 0.02 * (first - 1.5e-3), "heights of both halves");
    expect(moved > 0.0 && fabs(error) < 1e-3, "ledger"); /* 30 to 80 steps a contact, second order */
    expect(memory.live == early && memory.peak < 1000000, "memory does not grow");
    dem_free(&w);
    expect(memory.live == 0, "all is freed");
}

/* The same steps, however many went before. */
static void run_late(void) {
    enum { LATE = 1000000 };
    static const int64_t before[] = {0, ((int64_t)1 << 31) - (LATE / 2 / 256) * 256,
                                     ((int64_t)1 << 32) - (LATE / 2 / 256) * 256, (int64_t)1 << 52};
    dem_vec x[FEW], v[FEW];
    for (int k = 0; k < 4; k++) {
        counted memory = {0, 0};
        dem_world w;
        few_spheres(&w, &memory, before[k]);
        expect(dem_run(&w, LATE * w.def.dt, DEM_LINEAR | DEM_FRICTION) == DEM_OK, "late run");
        expect(w.step == before[k] + LATE, "late steps");
        for (int i = 0; i < FEW; i++) {
            const dem_vec at = dem_position(&w, i), speed = dem_velocity(&w, i);
            if (k == 0) x[i] = at, v[i] = speed;
            expect(at.z == x[i].z && speed.z == v[i].z, "the same motion beyond 2^31, 2^32 and 2^52 steps");
        }
        dem_free(&w);
    }
    printf("%d steps from step 0, across 2^31, across 2^32 and from 2^52 on: the same bits\n", LATE);
}

/* ---- large ---- */

/* Columns of two spheres on a floor, each as deep in what is below it as it is heavy. */
static void columns(dem_world *w, counted *memory, ptrdiff_t n, double d, double *top) {
    const dem_def def = definition(memory);
    const double mass = 2500.0 * RIDDLE_PI / 6.0 * d * d * d, sunk = mass * 9.81 / 1000.0;
    const ptrdiff_t side = (ptrdiff_t)sqrt(0.5 * (double)n);
    double *at = (double *)malloc((size_t)n * 3 * sizeof *at), *size = (double *)malloc((size_t)n * sizeof *size);
    expect(at && size && dem_init(w, &def, NULL) == DEM_OK, "init");
    for (ptrdiff_t k = 0; at && size && k < n; k++) {
        at[3 * k] = 1.05 * d * (double)(k / 2 % side), at[3 * k + 1] = 1.05 * d * (double)(k / 2 / side);
        at[3 * k + 2] = k % 2 ? 1.5 * d - 3.0 * sunk : 0.5 * d - 2.0 * sunk;
        size[k] = d;
    }
    *top = 1.5 * d - 3.0 * sunk;
    dem_add_plane(w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
    expect(dem_add_spheres(w, n, at, size, 0, 0) == DEM_OK, "add");
    free(at), free(size);
}

static void is_at_rest(const dem_world *w, double d, double top, const char *what) {
    double farthest = 0.0, fastest = 0.0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        /* the lower one bears two, the upper one itself */
        const double start = i % 2 ? top : top - d + (1.5 * d - top) / 3.0;
        const double off = fabs(dem_position(w, i).z - start), v = dem__length(dem_velocity(w, i));
        farthest = off > farthest ? off : farthest;
        fastest = v > fastest ? v : fastest;
    }
    printf("%s: step %lld, %ld spheres, %ld contacts: at most %.1e m from where they were, %.1e m/s\n", what,
           (long long)w->step, (long)w->count, (long)dem_contact_count(w), farthest, fastest);
    expect(farthest < 1e-12 && fastest < 1e-9, "spheres at rest stay there");
    expect(dem_contact_count(w) == w->count, "two contacts a column");
}

static void run_large(ptrdiff_t n) {
    const double d = 2e-3;
    counted memory = {0, 0};
    double top;
    dem_world w;
    const clock_t begin = clock();
    columns(&w, &memory, n, d, &top);
    n = w.count;
    expect(dem_run(&w, 20.0 * w.def.dt, DEM_LINEAR | DEM_FRICTION) == DEM_OK, "run");
    is_at_rest(&w, d, top, "large");
    const double pairs = (double)w.engine->pairs.count, least = 6.0 * (double)n;
    const double stated =
        572.0 * (double)n + 40.0 * (pairs > least ? pairs : least) + 340.0 * (double)dem_contact_count(&w);
    printf("held %.2f GB, at most %.2f GB while arrays grew; the manual's sums: %.2f GB, and half as much again for "
           "growing\n",
           1e-9 * (double)memory.live, 1e-9 * (double)memory.peak, 1e-9 * stated);
    expect((double)memory.live < 1.5 * stated + 1e6, "memory as the manual states");
    const size_t size = dem_save(&w, NULL, 0);
    void *bytes = malloc(size);
    expect(bytes && dem_save(&w, bytes, size) == size, "save");
    expect(dem_run(&w, 5.0 * w.def.dt, DEM_LINEAR | DEM_FRICTION) == DEM_OK, "run");
    const uint64_t hash = dem_hash(&w);
    dem_free(&w);
    expect(memory.live == 0, "all is freed");
    memory.peak = 0;
    const dem_allocator hook = {count_bytes, &memory};
    expect(bytes && dem_load(&w, bytes, size, &hook) == DEM_OK, "load");
    free(bytes);
    expect(dem_run(&w, 5.0 * w.def.dt, DEM_LINEAR | DEM_FRICTION) == DEM_OK, "run after a load");
    expect(dem_hash(&w) == hash, "a loaded run continues with the same bits");
    is_at_rest(&w, d, top, "loaded");
    printf("a save of %.2f GB; gone on from it in %.2f GB, at most %.2f GB; %.1f s of processor time in all\n",
           1e-9 * (double)size, 1e-9 * (double)memory.live, 1e-9 * (double)memory.peak,
           (double)(clock() - begin) / CLOCKS_PER_SEC);
    expect((double)memory.live < 1.5 * stated + 1e6, "memory after a load");
    dem_free(&w);
}

int main(int argc, char **argv) {
    const double steps = argc > 1 ? atof(argv[1]) : 1e8, spheres = argc > 2 ? atof(argv[2]) : 2e6;
    run_long((int64_t)steps);
    run_late();
    run_large((ptrdiff_t)spheres);
    if (failures == 0) printf("all as it should be\n");
    return failures > 0;
}
