/* Defaults and checks of a definition; making and freeing a world. */
#pragma once
#include "triangles.h"
#include "vectors.h"
#include "arrays.h"

DEM_API const char *dem_status_text(dem_status status) {
    switch (status) {
#define DEM__CASE(name, text)                                                                                          \
    case name: return text;
        DEM_STATUSES(DEM__CASE)
#undef DEM__CASE
    case DEM_STATUS_COUNT: break;
    }
    return "unknown status";
}

DEM_API const char *dem_error_text(const dem_world *world) { return world && world->refusal ? world->refusal : ""; }

DEM_API int dem_build_is_deterministic(void) {
    volatile double a = 1.0 + 0x1p-30, b = 1.0 - 0x1p-30, c = -1.0;
    double x = a, y = b, z = c, fused = x * y + z; /* exactly -2^-60 if fused, 0 if not */
    return (FLT_EVAL_METHOD == 0 || FLT_EVAL_METHOD == 1) && fused == 0.0;
}

DEM_API dem_def dem_default_def(void) {
    dem_def def;
    memset(&def, 0, sizeof def);
    def.cookie = 0x6d656452u;
    def.threads = 1;
    def.skip = DEM_SKIP_ALL;
    def.dt = 1e-6;
    def.skin = 0.35;
    def.gravity = dem_vec3(0.0, 0.0, -9.81);
    def.high = dem_vec3(1.0, 1.0, 1.0);
    def.allocator.fn = dem__default_allocator;
    for (int a = 0; a < DEM_MATERIALS_MAX; a++) {
        for (int b = 0; b < DEM_MATERIALS_MAX; b++) {
            dem_pair_def *pair = &def.pair[a][b];
            pair->stiffness = 1e5;
            pair->tangential_ratio = 2.0 / 7.0;
            pair->restitution = 0.8;
            pair->friction = 0.3;
        }
    }
    return def;
}

DEM_API int dem_add_material(dem_def *def, double density, double young_modulus, double poisson_ratio) {
    if (!def || def->materials < 0 || def->materials >= DEM_MATERIALS_MAX) return -1;
    dem_material *material = &def->material[def->materials];
    material->density = density;
    material->young_modulus = young_modulus;
    material->poisson_ratio = poisson_ratio;
    return def->materials++;
}

DEM_API dem_pair_def *dem_pair(dem_def *def, int a, int b) {
    if (!def || a < 0 || b < 0 || a >= DEM_MATERIALS_MAX || b >= DEM_MATERIALS_MAX) return NULL;
    dem_pair_def *pair = a < b ? &def->pair[a][b] : &def->pair[b][a];
    pair->given = 1;
    return pair;
}

static inline int dem__finite(double v) { return fabs(v) <= DBL_MAX; }
static inline int dem__finite_vec(dem_vec v) { return dem__finite(v.x) && dem__finite(v.y) && dem__finite(v.z); }
static inline int dem__positive(double v) { return v > 0.0 && v <= DBL_MAX; }
static inline int dem__not_negative(double v) { return v >= 0.0 && v <= DBL_MAX; }

/* Returns whether an acceleration, a velocity or a spin is so small that products of three, as in energies, stay
   finite. False for NaN. */
static inline int dem__moderate(double v) { return fabs(v) <= 1e80; }
static inline int dem__moderate_vec(dem_vec v) {
    return dem__moderate(v.x) && dem__moderate(v.y) && dem__moderate(v.z);
}
/* Returns whether squares of distances to a place stay finite. */
static inline int dem__is_place(dem_vec v) { return fabs(v.x) <= 1e150 && fabs(v.y) <= 1e150 && fabs(v.z) <= 1e150; }

/* Returns whether the squares of a time step, and quotients by them, stay normal numbers. */
static inline int dem__is_time_step(double dt) { return dt >= 1e-60 && dt < 1e6; }

/* Returns whether a world has room for the data of a law. */
static inline int dem__is_law(const dem_law *law) {
    return law && law->force && law->states >= 0 && law->states <= DEM_STATE_MAX && law->vectors >= 0 &&
           law->history <= law->states && law->vectors <= law->history / 3 && law->constants >= 0 &&
           law->constants <= DEM_CONSTANTS_MAX;
}

/* Returns a number that identifies the meaning of a law's states: FNV-1a of its name up to a comma, and its version; 0
   without a name. Worlds keep and save it instead of the name, which may have any length. */
static inline uint64_t dem__law_mark(const dem_law *law) {
    uint64_t mark = 0xcbf29ce484222325u;
    const char *c = law->name;
    if (!c) return 0;
    for (; *c && *c != ','; c++) mark = (mark ^ (unsigned char)*c) * 0x100000001b3u;
    for (int k = 0; k < 4; k++) mark = (mark ^ ((uint32_t)law->version >> (8 * k) & 255u)) * 0x100000001b3u;
    return mark;
}

/* Returns whether states with a mark can belong to a law. */
static inline int dem__is_of_law(uint64_t mark, const dem_law *law) {
    const uint64_t own = dem__law_mark(law);
    return mark == 0 || own == 0 || mark == own;
}

DEM_INLINE int dem__is_thread_count(int threads) { return threads >= 1 && threads <= 4096; }

/* Returns the name of the first bad field, or NULL. */
DEM__STATIC const char *dem__bad_pair(const dem_pair_def *p) {
    if (!dem__positive(p->stiffness)) return "pair.stiffness";
    if (!(p->tangential_ratio >= 0.0 && p->tangential_ratio <= 1.0)) return "pair.tangential_ratio";
    if (!(p->restitution > 0.0 && p->restitution <= 1.0)) return "pair.restitution";
    if (!dem__not_negative(p->friction)) return "pair.friction";
    if (!dem__not_negative(p->rolling)) return "pair.rolling";
    if (!dem__not_negative(p->tangential_damping)) return "pair.tangential_damping";
    if (p->mode != DEM_CLIPPED && p->mode != DEM_NAIVE) return "pair.mode";
    return NULL;
}

/* Returns the first bad field of a pair and what is wrong with it, or NULL. */
static inline const char *dem__wrong_pair(const dem_pair_def *p) {
    static const char *const text[] = {
        "pair.stiffness: not a finite number above 0", "pair.tangential_ratio: not 0 .. 1",
        "pair.restitution: not above 0 and at most 1", "pair.friction: below 0 or not finite",
        "pair.rolling: below 0 or not finite",         "pair.tangential_damping: below 0 or not finite",
        "pair.mode: neither DEM_CLIPPED nor DEM_NAIVE"};
    const char *field = dem__bad_pair(p);
    if (!field) return NULL;
    for (size_t k = 0; k < sizeof text / sizeof text[0]; k++) {
        const size_t length = strlen(field);
        if (strncmp(text[k], field, length) == 0 && text[k][length] == ':') return text[k];
    }
    return field;
}

/* Returns the name of the first bad field, or NULL. */
DEM__STATIC const char *dem__bad_field(const dem_def *def) {
    if (!def) return "def";
    if (def->cookie != 0x6d656452u) return "cookie";
    if (def->materials < 1 || def->materials > DEM_MATERIALS_MAX) return "materials";
    if (!dem__is_thread_count(def->threads)) return "threads";
    if (def->skip < 0 || def->skip > DEM_SKIP_ALL) return "skip";
    if (!dem__is_time_step(def->dt)) return "dt";
    if (!(def->skin > 0.0 && def->skin < 100.0)) return "skin";
    if (!dem__moderate_vec(def->gravity)) return "gravity";
    for (int a = 0; a < 3; a++) {
        const double low = dem_axis(def->low, a), high = dem_axis(def->high, a);
        if (def->periodic[a] != 0 && def->periodic[a] != 1) return "periodic";
        if (def->periodic[a] && !dem__positive(high - low)) return "high";
    }
    if (!def->allocator.fn) return "allocator.fn";
    for (int a = 0; a < def->materials; a++) {
        if (!dem__positive(def->material[a].density)) return "material.density";
        if (!dem__positive(def->material[a].young_modulus)) return "material.young_modulus";
        if (!(def->material[a].poisson_ratio >= 0.0 && def->material[a].poisson_ratio <= 0.5))
            return "material.poisson_ratio";
        for (int b = a; b < def->materials; b++) {
            const char *bad = dem__bad_pair(&def->pair[a][b]);
            if (bad) return bad;
        }
    }
    return NULL;
}

DEM_API dem_status dem_check_def(const dem_def *def, const char **field) {
    const char *bad = dem__bad_field(def);
    if (field) *field = bad;
    return bad ? DEM_BAD_DEFINITION : DEM_OK;
}

/* Makes room for the forces of chunks on walls, which each step computes again. Returns 0 when out of memory. */
static inline int dem__fit_wall_forces(dem_world *w, int chunks) {
    dem__contacts *contacts = &w->engine->contacts;
    const dem_allocator *a = &w->def.allocator;
    const int room = chunks > 1 ? DEM__CHUNKS : 1;
    const size_t bytes = (size_t)room * (size_t)w->engine->walls.capacity * sizeof *contacts->wall_force;
    if (room <= contacts->force_chunks) return 1;
    dem__wall_force *fresh = (dem__wall_force *)a->fn(a->user, NULL, 0, bytes);
    if (!fresh) return 0;
    memset(fresh, 0, bytes);
    a->fn(a->user, contacts->wall_force, bytes / (size_t)room * (size_t)contacts->force_chunks, 0);
    contacts->wall_force = fresh, contacts->force_chunks = room;
    return 1;
}

/* Makes room for `wanted` walls, and for the forces of every chunk on them. Returns 0 when out of memory. */
static inline int dem__grow_walls(dem_world *w, ptrdiff_t wanted) {
    dem__engine *e = w->engine;
    const dem_allocator *a = &w->def.allocator;
    const ptrdiff_t larger = e->walls.capacity + e->walls.capacity / 2 + 8, room = larger > wanted ? larger : wanted;
    const size_t wall = sizeof *w->wall, force = (size_t)e->contacts.force_chunks * sizeof *e->contacts.wall_force;
    if (wanted <= e->walls.capacity) return 1;
    dem_wall *walls = (dem_wall *)a->fn(a->user, NULL, 0, (size_t)room * wall);
    dem__wall_force *forces = (dem__wall_force *)a->fn(a->user, NULL, 0, (size_t)room * force);
    if (!walls || !forces) {
        if (walls) a->fn(a->user, walls, (size_t)room * wall, 0);
        if (forces) a->fn(a->user, forces, (size_t)room * force, 0);
        return 0;
    }
    memset(walls, 0, (size_t)room * wall);
    memset(forces, 0, (size_t)room * force);
    if (w->wall) {
        memcpy(walls, w->wall, (size_t)e->walls.capacity * wall);
        a->fn(a->user, w->wall, (size_t)e->walls.capacity * wall, 0);
        a->fn(a->user, e->contacts.wall_force, (size_t)e->walls.capacity * force, 0);
    }
    w->wall = walls;
    e->contacts.wall_force = forces;
    e->walls.capacity = room;
    return 1;
}

/* Makes the private state of an empty world, with room for the first walls, so that the array rarely moves. Returns 0
   when out of memory. */
static inline int dem__make_engine(dem_world *w) {
    dem__engine *e = (dem__engine *)w->def.allocator.fn(w->def.allocator.user, NULL, 0, sizeof *e);
    if (!e) return 0;
    memset(e, 0, sizeof *e);
    e->run.dt = w->def.dt;
    e->run.has_periodic = w->def.periodic[0] | w->def.periodic[1] | w->def.periodic[2];
    e->run.needs_lists = e->contacts.chunk_count = e->contacts.force_chunks = 1;
    w->engine = e;
    if (dem__grow_walls(w, 1)) return 1;
    w->def.allocator.fn(w->def.allocator.user, e, sizeof *e, 0);
    w->engine = NULL;
    return 0;
}

DEM_API dem_status dem_init(dem_world *world, const dem_def *def, const char **field) {
    if (field) *field = world ? NULL : "world";
    if (!world) return DEM_BAD_ARGUMENT;
    memset(world, 0, sizeof *world);
    dem_status status = dem_check_def(def, field);
    if (status != DEM_OK) return status;
    world->def = *def;
    if (!dem__make_engine(world)) {
        memset(world, 0, sizeof *world);
        return DEM_OUT_OF_MEMORY;
    }
    world->engine->run.needs_forces = 1;
    return DEM_OK;
}

/* Returns whether a run of the world is in progress: the caller is then a law's hook. */
static inline int dem__is_running(const dem_world *w) { return w && w->engine && w->engine->run.running; }

static inline void dem__release(const dem_allocator *a, void *block, size_t bytes) {
    if (block) a->fn(a->user, block, bytes, 0);
}

DEM_API dem_status dem_set_pair(dem_world *world, int a, int b, const dem_pair_def *pair) {
    dem_world *w = world;
    if (dem__is_running(w)) return DEM_BUSY;
    if (dem__lacks_memory(w)) return DEM_BAD_ARGUMENT;
    if (a < 0 || a >= w->def.materials) return dem__refuse(w, "a: the world has no material of this index");
    if (b < 0 || b >= w->def.materials) return dem__refuse(w, "b: the world has no material of this index");
    if (!pair) return dem__refuse(w, "pair: NULL");
    const char *wrong = dem__wrong_pair(pair);
    if (wrong) return dem__refuse(w, wrong);
    dem_pair_def *own = dem_pair(&w->def, a, b);
    *own = *pair, own->given = 1;
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    return DEM_OK;
}

DEM_API void dem_free(dem_world *world) {
    if (!world || !world->def.allocator.fn || dem__is_running(world)) return;
    const dem_allocator a = world->def.allocator;
    dem__engine *e = world->engine;
    DEM__TELL(world, release, (world));
    dem__release(&a, e->bodies.block, e->bodies.bytes);
    dem__release(&a, e->contacts.block, e->contacts.bytes);
    dem__release(&a, e->pairs.timers.block, e->pairs.timers.bytes);
    dem__release(&a, e->walls.timers.block, e->walls.timers.bytes);
    dem__release(&a, e->pairs.adjacent, (size_t)e->pairs.adjacent_capacity * sizeof(int32_t));
    dem__release(&a, e->pairs.cells, (size_t)e->pairs.cells_capacity * sizeof(int32_t));
    dem__release(&a, world->passed, (size_t)e->bodies.passed_capacity * sizeof *world->passed);
    for (int k = 0; k < world->walls; k++) {
        dem__tree *tree = world->wall[k].tree;
        if (tree && tree->edges) dem__release(&a, tree->edges, tree->edges->bytes);
        if (tree) dem__release(&a, tree, tree->bytes);
    }
    dem__release(&a, world->wall, (size_t)e->walls.capacity * sizeof *world->wall);
    dem__release(&a, e->contacts.wall_force,
                 (size_t)e->contacts.force_chunks * (size_t)e->walls.capacity * sizeof *e->contacts.wall_force);
    dem__release(&a, e->scratch.work_block, e->scratch.work_bytes);
    dem__release(&a, e, sizeof *e);
    memset(world, 0, sizeof *world);
}
