/* Any program of public calls of dem.h, legal and not. Two worlds get the same calls: they skip other things, share
   their tasks otherwise, run out of memory at other places, and now and then one is thrown away for what the other
   saves. What must hold:
   - both answer the same, with a status that the call documents, and a refused call changes nothing;
   - both end with the same bits: hash, ledger, time, records of exits;
   - readers and saves change nothing;
   - a save with one number changed is refused, or makes a world that can be read, run, saved and freed;
   - a run within the advised time step closes the ledger; energies are numbers whenever a run says ok;
   - what the world holds is bounded by the spheres and walls that it has had at a time. */
#include "dem_calls.h"

/* of the energy that a run moves: contacts have 20 steps or more, overlaps stay below a tenth of a radius */
#define LEDGER_TOLERANCE 0.02
#define DEEP 0.1 /* overlap over radius, and speed [m/s], beyond which the ledger is not judged */
#define FAST 1.0
/* Seeds: programs from here on have clumps, polyhedra and fields, too; those below stay the same. */
#define FIRST_WITH_BODIES 100000
#define FIRST_WITH_FIXED 200000 /* and fixed particles and all the rest of the public functions */
#define FIRST_WITH_COMPOUNDS 300000

/* ---- what a call may answer ---- */

static int is_documented(const call *c, dem_status status, int memory_failed) {
    const int runs = c->kind == RUN || c->kind == RUN_LAW, fills = c->kind >= FILL && c->kind <= FEED_MASS;
    const int adds = c->kind == ADD_SPHERES || fills || (c->kind >= ADD_PLANE && c->kind <= ADD_EXIT) ||
                     (c->kind >= ADD_CLUMPS && c->kind <= ADD_CONVEX) || c->kind == FILL_IN_MESH;
    switch (status) {
    case DEM_OK: return 1;
    case DEM_BAD_ARGUMENT: return 1;
    case DEM_OUT_OF_MEMORY: return memory_failed;
    case DEM_TOO_MANY: return adds;
    case DEM_LAW_MISMATCH: return runs || c->kind == SET_LINKS;
    case DEM_NOT_FINITE:
    case DEM_TOO_FAST:
    case DEM_BAD_DEFINITION: return runs;
    case DEM_POLYHEDRON: return runs || c->kind == ADD_LINK;
    default: return 0;
    }
}

/* Calls that have what they need and no odd number are legal: they must succeed, whatever happened before. But a load
   may be too large for a sphere that was added with an odd diameter, 1e-58 m: its acceleration is refused. */
static int must_succeed(const side *s, const call *c, int extreme) {
    const int of_wall = c->kind >= VIBRATE && c->kind <= ENABLE_WALL;
    const int of_sphere = c->kind == SET_MOTION || c->kind == SET_LOAD || c->kind == REMOVE;
    if (c->odd >= 0 || c->kind == ADD_LINK || c->kind == SET_LINKS || c->kind == RUN || c->kind == RUN_LAW) return 0;
    if (extreme && c->kind == SET_LOAD) return 0;
    if (s->w.engine->bodies.has_fixed && c->kind == SET_MOTION) return 0; /* a fixed body does not turn */
    if (c->kind >= OLD_CALLS && c->kind != SET_WALL_GROUPS) return 0;
    if (of_wall || c->kind == SET_WALL_GROUPS) return s->w.walls > 0;
    if (of_sphere) return spheres_present(&s->w) > 0;
    return !(c->kind >= ADD_PLANE && c->kind <= ADD_EXIT) && !(c->kind >= FILL && c->kind <= FEED_MASS);
}

/* ---- comparing ---- */

static void mix_energy(uint64_t *hash, const dem_energy_ledger *l) {
    const double *sum = &l->kinetic;
    for (size_t k = 0; k < sizeof *l / sizeof *sum; k++) fuzz_mix_number(hash, sum[k]);
}
static uint64_t digest(const dem_world *w) {
    uint64_t hash = dem_hash(w);
    const dem_energy_ledger ledger = dem_energy(w);
    mix_energy(&hash, &ledger);
    fuzz_mix_number(&hash, w->time), fuzz_mix_number(&hash, w->owed);
    fuzz_mix_bits(&hash, (uint64_t)w->step), fuzz_mix_bits(&hash, (uint64_t)w->passed_total);
    fuzz_mix_bits(&hash, (uint64_t)dem_contact_count(w)), fuzz_mix_bits(&hash, (uint64_t)dem_link_count(w));
    fuzz_mix_bits(&hash, (uint64_t)spheres_present(w));
    for (ptrdiff_t k = 0; k < w->passed_count; k++)
        fuzz_mix_bits(&hash, w->passed[k].id), fuzz_mix_number(&hash, w->passed[k].time);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dem_vec of[3];
        if (!dem_is_fixed(w, i)) continue;
        FUZZ_HOLDS(dem_get_fixed_force(w, i, &of[0], &of[1], &of[2]) == DEM_OK);
        for (int k = 0; k < 9; k++) fuzz_mix_number(&hash, dem_axis(of[k / 3], k % 3));
    }
    return hash;
}

/* In a trace: what of two particles differs that their motion does not show. */
static void tell_hidden_difference(const dem_world *a, ptrdiff_t i, const dem_world *b, ptrdiff_t j) {
    const dem_particle *p = &a->particle[i], *q = &b->particle[j];
    const double *load = a->engine->bodies.load[i], *other = b->engine->bodies.load[j];
    if (p->origin != q->origin || dem_is_fixed(a, i) != dem_is_fixed(b, j))
        fprintf(stderr, "particle %ld: origin %lld %lld, fixed %d %d, activity %d %d\n", (long)i, (long long)p->origin,
                (long long)q->origin, dem_is_fixed(a, i), dem_is_fixed(b, j), a->engine->bodies.activity[i],
                b->engine->bodies.activity[j]);
    for (int k = 0; k < 3; k++) {
        const double v[] = {dem_axis(p->a, k), dem_axis(a->spin_rate[i], k), load[k], load[3 + k]};
        const double u[] = {dem_axis(q->a, k), dem_axis(b->spin_rate[j], k), other[k], other[3 + k]};
        for (int m = 0; m < 4; m++)
            if (memcmp(&v[m], &u[m], sizeof v[m]) != 0)
                fprintf(stderr, "particle %ld, number %d of axis %d: %.17g %.17g\n", (long)i, m, k, v[m], u[m]);
    }
    if (!dem_is_fixed(a, i) || !dem_is_fixed(b, j)) return;
    for (int k = 0; k < 6; k++)
        fprintf(stderr, "force %.17g %.17g\n", a->engine->bodies.fixed[i].load[k], b->engine->bodies.fixed[j].load[k]);
}

/* In a trace: in what two worlds differ. */
static void tell_difference(const dem_world *a, const dem_world *b) {
    const dem_energy_ledger ledger[2] = {dem_energy(a), dem_energy(b)};
    fprintf(stderr, "a: hash %016llx step %lld contacts %ld; b: hash %016llx step %lld contacts %ld\n",
            (unsigned long long)dem_hash(a), (long long)a->step, (long)dem_contact_count(a),
            (unsigned long long)dem_hash(b), (long long)b->step, (long)dem_contact_count(b));
    for (size_t k = 0; k < sizeof ledger[0] / sizeof(double); k++) {
        const double x = (&ledger[0].kinetic)[k], y = (&ledger[1].kinetic)[k];
        if (x != y) fprintf(stderr, "ledger, number %d: %.17g %.17g\n", (int)k, x, y);
    }
    for (ptrdiff_t i = 0, j = 0; i < a->count && j < b->count; i++, j++) { /* by the order of those present */
        while (i < a->count && a->alive[i] != DEM_PRESENT) i++;
        while (j < b->count && b->alive[j] != DEM_PRESENT) j++;
        if (i == a->count || j == b->count) break;
        const dem_body p = dem_get_body(a, i), q = dem_get_body(b, j);
        tell_hidden_difference(a, i, b, j);
        if (memcmp(&p.mass, &q.mass, sizeof p - offsetof(dem_body, mass)) == 0) continue;
        fprintf(stderr, "%s %ld: x %.17g %.17g %.17g, v %.17g %.17g %.17g, spin %.17g %.17g %.17g\n", "particle",
                (long)i, p.position.x, p.position.y, p.position.z, p.velocity.x, p.velocity.y, p.velocity.z, p.spin.x,
                p.spin.y, p.spin.z);
        fprintf(stderr, "%s %ld: x %.17g %.17g %.17g, v %.17g %.17g %.17g, spin %.17g %.17g %.17g\n", "against ",
                (long)j, q.position.x, q.position.y, q.position.z, q.velocity.x, q.velocity.y, q.velocity.z, q.spin.x,
                q.spin.y, q.spin.z);
    }
}

static unsigned char *saved(const dem_world *w, size_t *size) {
    *size = dem_save(w, NULL, 0);
    unsigned char *bytes = (unsigned char *)malloc(*size);
    FUZZ_HOLDS(*size > 0 && bytes);
    memset(bytes, 0xEE, *size);
    FUZZ_HOLDS(dem_save(w, bytes, *size - 1) == *size && bytes[0] == 0xEE); /* too small: nothing is written */
    FUZZ_HOLDS(dem_save(w, bytes, *size) == *size);
    return bytes;
}

/* Pure functions, of any numbers. */
static void compute_all(const call *c) {
    const double x = number(c, 0, 0.0, 1.0), y = number(c, 1, 0.1, 10.0), z = number(c, 2, 1e-6, 1.0);
    const dem_sizes sizes = sizes_of(c);
    uint64_t random = 1;
    double shape[3];
    dem_mesh mesh;
    dem_draw_size(&sizes, &random);
    dem_restitution_of(dem_damping_ratio(x, DEM_CLIPPED), DEM_NAIVE),
        dem_contact_time(y, z, x, c->pick[0] % 2 ? DEM_NAIVE : DEM_CLIPPED);
    dem_hertz_contact_time(1e7 * y, z, x, y), dem_shape_of_drag(x, y, z, shape);
    dem_ball_in_box(z, dem_vec3(-x, -y, -z), vector(c, 3, 1.0));
    dem_status_text((dem_status)(c->pick[0] % 40 - 2));
    if (read_tetrahedron(c, &mesh) != DEM_OK) return;
    const dem_region region = dem_mesh_region(&mesh);
    dem_region_volume(&region), dem_region_holds(&region, vector(c, 3, 1e-3));
    dem_free_mesh(&mesh);
}

/* Every reader, with what is there and what is not. */
static void read_all(const side *s, const call *c) {
    enum { CELLS = 8, BINS = 5 };
    const dem_world *w = &s->w;
    const dem_region region = region_of(c);
    dem_measure measure;
    dem_field field[CELLS];
    dem_cells cells = {{-HALF, -HALF, -HALF}, {HALF, HALF, HALF}, {2, 2, 2}, {1e-3, 0.0, 2e-3}};
    dem_vec at;
    double bins[BINS], of_group[CELLS], of_all[CELLS], entered[4], stayed[4] = {0.0, 0.0, 0.0, 0.0};
    for (int k = 0; k < 4; k++) entered[k] = (double)NAN;
    for (ptrdiff_t i = -1; i <= w->count; i++) {
        dem_position(w, i), dem_velocity(w, i), dem_spin(w, i), dem_orientation(w, i), dem_radius(w, i), dem_mass(w, i),
            dem_get_body(w, i);
        dem_get_shape(w, dem_shape_of(w, i)), dem_wall_acts(w, c->pick[2] % 4, i),
            dem_get_fixed_force(w, i, &at, &at, &at);
    }
    compute_all(c), dem_check_def(&w->def, NULL);
    dem_core_overlaps(w), dem_core_overlap_steps(w), dem_gas_velocity(&s->gas, region.low, w->time),
        dem_gas_porosity(w, &s->gas, of_all);
    dem_region_volume(&region), dem_region_holds(&region, region.low), dem_hash(w), dem_build_is_deterministic();
    for (ptrdiff_t k = -1; k <= dem_contact_count(w); k++) dem_get_contact(w, k);
    for (ptrdiff_t k = -1; k <= dem_link_count(w); k++) dem_get_link(w, k);
    for (int k = -1; k <= w->walls; k++) dem_count_apertures(w, k);
    dem_find_link(w, c->pick[0] % 64, c->pick[1] % 64, 0), dem_find_link(w, -1, -100, -1);
    dem_momentum(w), dem_advise(w, features_of(c), number(c, 9, 0.1, 1.0)), dem_unlike_contacts(w, c->pick[0] % 3);
    dem_measure_region(w, &region, &measure);
    cells.low.x = number(c, 10, -HALF, 0.0), cells.width[1] = number(c, 11, 0.0, 1e-3);
    dem_coarse_grain(w, &cells, field);
    dem_count_in_cells(w, &cells, 0, of_group, of_all);
    dem_histogram(w, c->pick[1] % 2 ? DEM_CONTACT_FORCE : DEM_CONTACT_OVERLAP, 0.0, number(c, 12, 1e-4, 1e-2), BINS,
                  bins);
    dem_residence(w, &region, 4, entered, stayed);
    dem_mixing_of(CELLS, of_group, of_all);
}

static void readers_change_nothing(const side *s, const call *c) {
    size_t size[2];
    unsigned char *bytes[2] = {saved(&s->w, &size[0]), NULL};
    const int calls = s->memory.calls;
    read_all(s, c);
    bytes[1] = saved(&s->w, &size[1]);
    FUZZ_HOLDS(size[0] == size[1] && memcmp(bytes[0], bytes[1], size[0]) == 0 && s->memory.calls == calls);
    free(bytes[0]), free(bytes[1]);
}

/* ---- worlds ---- */

/* The host's threads: each task in turn, the last first. */
static void run_backwards(void *user, int tasks, void (*task)(void *context, int index), void *context) {
    (void)user;
    for (int k = tasks; k-- > 0;) task(context, k);
}
static void set_threads(side *s) {
    s->w.def.threads = s->threads;
    s->w.def.parallel = s->backwards ? run_backwards : NULL;
}

static dem_def draw_def(fuzz_draws *d) {
    dem_def def = scene_def(fuzz_one_of(d, 2) ? 4e-6 : 5e-6);
    for (int a = 0; a < 2; a++) {
        for (int b = a; b < 2; b++) dem_pair(&def, a, b)->stiffness = 600.0 + 200.0 * (a + b);
    }
    def.material[1].young_modulus = 5e7;
    def.gravity = fuzz_one_of(d, 4) ? dem_vec3(1.0, 0.0, -9.81) : dem_vec3(0, 0, 0);
    def.skin = 0.05 + fuzz_uniform(d);
    for (int a = 0; a < 3; a++) def.periodic[a] = fuzz_one_of(d, 5) == 0;
    def.low = dem_vec3(-HALF, -HALF, -HALF), def.high = dem_vec3(HALF, HALF, HALF);
    return def;
}

/* A compound of two bricks, one across the end of the other. */
static void make_angle(side *s, const dem_convex *brick) {
    const dem_convex parts[2] = {*brick, *brick};
    const double places[6] = {0.0, 0.0, 0.0, 1e-3, 0.0, 3e-3}, turns[8] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0};
    FUZZ_HOLDS(dem_make_compound(&s->w, 2, parts, places, turns, &s->compound, NULL) == DEM_OK);
}

static void begin(side *s, const dem_def *def, int skip, int threads, int backwards, int bodies) {
    dem_def own = *def;
    memset(s, 0, sizeof *s);
    failing_init(&s->memory);
    own.allocator.fn = failing_fn, own.allocator.user = &s->memory;
    own.skip = skip;
    s->threads = s->most_threads = threads, s->backwards = backwards;
    s->feed = dem_default_feed(), s->gas = dem_default_gas();
    const double of_clump[6] = {0.0, 0.0, 0.0, 2e-3, 0.0, 0.0}, sizes[2] = {3e-3, 2e-3};
    s->bodies = bodies;
    FUZZ_HOLDS(dem_make_clump(2, of_clump, sizes, &s->clump) == DEM_OK);
    FUZZ_HOLDS(dem_init(&s->w, &own, NULL) == DEM_OK);
    if (bodies > 1) {
        dem_convex brick;
        FUZZ_HOLDS(dem_make_brick(&brick, dem_vec3(2e-3, 2e-3, 4e-3), 0.05, NULL) == DEM_OK &&
                   dem_add_shape(&s->w, &brick) == 0);
        if (bodies > 2) make_angle(s, &brick);
    }
    set_threads(s);
}
static void end(side *s) {
    dem_free(&s->w);
    FUZZ_HOLDS(failing_live(&s->memory) == 0);
}

/* What `of` saves takes the place of `s`, in the memory of s. */
static void load_in_place(side *s, const side *of) {
    size_t size;
    unsigned char *bytes = saved(&of->w, &size);
    dem_allocator hook;
    hook.fn = failing_fn, hook.user = &s->memory;
    end(s);
    FUZZ_HOLDS(dem_load(&s->w, bytes, size, &hook) == DEM_OK);
    free(bytes);
    set_threads(s);
    s->feed = of->feed;
    if (s->feed.clump) s->feed.clump = &s->clump;
    if (s->feed.compound) s->feed.compound = &s->compound;
    s->links = of->links, s->interval = of->interval, s->near = of->near;
    for (int k = 0; k < s->w.walls; k++) {
        if (s->w.wall[k].asked.drive != DEM_PRESCRIBED) continue;
        FUZZ_HOLDS(dem_run(&s->w, 0.0, DEM_LINEAR) == DEM_NO_MOTION);
        FUZZ_HOLDS(dem_prescribe(&s->w, k, s->w.wall[k].asked.spin_centre, swing, NULL) == DEM_OK);
    }
    s->gas = of->gas, s->field = of->field;
    if (s->field.kernel) {
        FUZZ_HOLDS(dem_run(&s->w, 0.0, DEM_LINEAR) == DEM_NO_FIELD);
        FUZZ_HOLDS(hand_over_field(s) == DEM_OK);
    }
    if (s->links) FUZZ_HOLDS(dem_set_links(&s->w, &spring_kernel, s->interval, s->near) == DEM_OK);
}

/* Writes what a number of a save should not be: of 1, 4 or 8 bytes, a double or an integer. */
static void forge_number(fuzz_draws *d, unsigned char *at, int width) {
    static const int64_t odd[] = {0,  1,           2,          -1,    3,       31,        32,        100,
                                  -2, -2147483648, 2147483647, 65536, 1 << 29, INT64_MAX, INT64_MIN, 1000000000000};
    uint64_t bits = (uint64_t)odd[fuzz_one_of(d, (int)(sizeof odd / sizeof *odd))];
    const double number =
        fuzz_one_of(d, 3) ? fuzz_hostile_number(d) : (fuzz_uniform(d) - 0.5) * (fuzz_one_of(d, 2) ? 1e9 : 1e-3);
    if (width == 8 && fuzz_one_of(d, 4)) memcpy(&bits, &number, sizeof bits);
    for (int k = 0; k < width; k++) at[k] = (unsigned char)(bits >> (8 * k));
}

/* Changes a number of a save, or takes a record away, whatever its kind. Returns the new size. */
static size_t forge(fuzz_draws *d, unsigned char *bytes, size_t size) {
    size_t at = 16, of = 16;
    dem__record r, chosen = {0, 0, 0};
    for (int n = 1; at < size - 8; n++) { /* each is as likely, however long */
        FUZZ_HOLDS(dem__read_head(bytes, size - 8, at, &r));
        if (r.count > 0 && fuzz_one_of(d, n) == 0) of = at, chosen = r;
        at = r.at + (size_t)(r.bytes * r.count);
    }
    if (fuzz_traces) fprintf(stderr, "forges %.24s\n", (char *)bytes + of);
    if (fuzz_one_of(d, 12) == 0) {
        const size_t next = chosen.at + (size_t)(chosen.bytes * chosen.count);
        memmove(bytes + of, bytes + next, size - next);
        size -= next - of;
    } else {
        const int width = chosen.bytes % 8 == 0 ? 8 : chosen.bytes % 4 == 0 ? 4 : 1, last = (int)chosen.count - 1;
        const int entry = fuzz_one_of(d, 3) ? fuzz_one_of(d, (int)chosen.count) : fuzz_one_of(d, 2) ? last : 0;
        forge_number(d,
                     bytes + chosen.at + (size_t)entry * chosen.bytes +
                         (size_t)(width * fuzz_one_of(d, (int)(chosen.bytes / (uint64_t)width))),
                     width);
    }
    uint64_t check = dem__checksum(bytes, size - 8);
    for (int k = 0; k < 8; k++) bytes[size - 8 + (size_t)k] = (unsigned char)(check >> (8 * k));
    return size;
}

/* Loads forged saves of a side, and does with what comes out what one does with a world. */
static void load_forged(const side *of, const call *c, int times) {
    fuzz_draws d = {NULL, 0, dem_hash(&of->w)};
    for (int k = 0; k < times; k++) {
        size_t size;
        unsigned char *bytes = saved(&of->w, &size);
        side s = *of;
        dem_allocator hook;
        failing_init(&s.memory);
        hook.fn = failing_fn, hook.user = &s.memory;
        for (int n = 1 + fuzz_one_of(&d, 2); n > 0; n--) size = forge(&d, bytes, size);
        const dem_status status = dem_load(&s.w, bytes, size, &hook);
        free(bytes);
        FUZZ_HOLDS(status == DEM_OK || status == DEM_BAD_DATA || status == DEM_OUT_OF_MEMORY);
        if (status == DEM_OK) {
            set_threads(&s);
            for (int q = 0; q < s.w.walls; q++) {
                if (s.w.wall[q].asked.drive == DEM_PRESCRIBED)
                    dem_prescribe(&s.w, q, s.w.wall[q].asked.spin_centre, swing, NULL);
            }
            if (s.field.kernel) hand_over_field(&s);
            if (s.links) dem_set_links(&s.w, &spring_kernel, s.interval, s.near);
            read_all(&s, c);
            const double most = 5.0 * s.w.def.dt;
            for (int run = 0; run < 2; run++) run_for(&s.w, most, features_of(c), c->kind == RUN_LAW), read_all(&s, c);
            bytes = saved(&s.w, &size), free(bytes);
        }
        dem_free(&s.w);
        FUZZ_HOLDS(failing_live(&s.memory) == 0);
    }
}

/* ---- energy and memory ---- */

/* Is the ledger to be judged? Overlaps and speeds are moderate, the step is short enough, and nobody comes out of a
   wall on the other side of a periodic box. */
static int is_tame(const dem_world *w, int features) {
    if (!(w->def.dt <= dem_advise(w, features, FAST).advised)) return 0;
    for (int a = 0; a < 3; a++) {
        if (w->def.periodic[a] && w->walls > 0) return 0;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i] == DEM_PRESENT && !(dem__length(dem_velocity(w, i)) < FAST)) return 0;
    }
    for (ptrdiff_t k = 0; k < dem_contact_count(w); k++) {
        const dem_contact_info c = dem_get_contact(w, k);
        const double r = dem__touching_radius(w, c.i), other = c.j >= 0 ? dem__touching_radius(w, c.j) : r,
                     least = other < r ? other : r;
        if (!(-c.gap < DEEP * least)) return 0;
    }
    return 1;
}
static double moved(const dem_energy_ledger *l) {
    return l->kinetic + l->rotational + l->elastic + fabs(l->normal_loss) + fabs(l->sliding_loss) +
           fabs(l->rolling_loss) + fabs(l->wall_work) + fabs(l->external_work) + fabs(l->link_work) + fabs(l->added) +
           fabs(l->removed) + l->released;
}
static void energies_are_numbers(const dem_energy_ledger *l) {
    const double *sum = &l->kinetic;
    for (size_t k = 0; k < sizeof *l / sizeof *sum; k++) FUZZ_HOLDS(fabs(sum[k]) <= DBL_MAX);
}
static void ledger_closes(const dem_energy_ledger *before, const dem_energy_ledger *now) {
    const double error = fabs(now->error - before->error), scale = moved(now);
    FUZZ_HOLDS(error <= LEDGER_TOLERANCE * scale);
}

/* Bytes that so many spheres (80 more if some are fixed), walls and threads need at most: see Memory in the manual of
   dem.h. Spheres of these sizes have at most 12 near pairs and 8 contacts each that begin apart; where they lie on one
   point each has all others. */
typedef struct peaks {
    ptrdiff_t spheres, walls, pairs, contacts, links, passed;
} peaks;
static void note_peaks(peaks *p, const dem_world *w) {
#define NOTE(field, value) p->field = (value) > p->field ? (value) : p->field
    NOTE(spheres, w->count), NOTE(walls, w->walls), NOTE(contacts, dem_contact_count(w)),
        NOTE(links, dem_link_count(w));
    NOTE(pairs, w->engine->pairs.count), NOTE(passed, w->passed_count);
#undef NOTE
}
static void memory_is_bounded(const side *s, const peaks *p) {
    const double growth = 1.6, room = 1024.0;
    const double each = 540.0 + (s->w.engine->bodies.has_fixed ? 80.0 : 0.0) + 12.0 * (double)p->walls;
    const double spheres = each * ((double)p->spheres * growth + 64.0);
    const double others = 60.0 * ((double)p->pairs * growth + 6.0 * (double)p->spheres * growth + room) +
                          500.0 * ((double)p->contacts * growth + 8.0 * (double)p->spheres + 256.0) +
                          300.0 * ((double)p->links * growth + room) + 90.0 * ((double)p->passed * 3.0 + 256.0);
    const double fixed = 200e3 + 100e3 * s->most_threads + 10e3 * (double)p->walls;
    FUZZ_HOLDS((double)s->memory.live_bytes <= spheres + others + fixed);
}

/* ---- a program ---- */

typedef struct program {
    side a, b;
    peaks most;
    int extreme; /* an odd number was accepted: energies may be of any size */
    int over;    /* a run has failed: the world can be read, saved and freed, no more */
} program;

/* The call with memory that fails once in it; then again, with all the memory there is. */
static dem_status apply_short_of_memory(side *s, const call *c, int fail_at) {
    const int runs = c->kind == RUN || c->kind == RUN_LAW;
    const side before = *s;
    const uint64_t was = digest(&s->w);
    s->memory.fail_at = s->memory.calls + fail_at, s->memory.fail_count = 1;
    dem_status status = apply_call(s, c);
    s->memory.fail_at = -1;
    if (status != DEM_OUT_OF_MEMORY) return status;
    if (!runs) {
        FUZZ_HOLDS(digest(&s->w) == was);
        s->feed = before.feed;
        return apply_call(s, c);
    }
    FUZZ_HOLDS(s->w.owed == 0.0 || s->w.step == before.w.step);
    load_in_place(s, s);
    return DEM_OUT_OF_MEMORY;
}

static int has_failed(dem_status s) { return s == DEM_NOT_FINITE || s == DEM_TOO_FAST; }

static void try_call(program *p, fuzz_draws *d, const call *c) {
    side *a = &p->a, *b = &p->b;
    const int runs = c->kind == RUN || c->kind == RUN_LAW, short_of_memory = fuzz_one_of(d, 20) == 0,
              fail_at = fuzz_one_of(d, 6);
    const uint64_t before = digest(&a->w);
    const int needed = must_succeed(a, c, p->extreme);
    int tame = 0;
    if (runs) { /* contacts that are there already are found before the first step */
        const dem_status first = run_for(&a->w, 0.0, features_of(c), c->kind == RUN_LAW);
        const dem_status second = run_for(&b->w, 0.0, features_of(c), c->kind == RUN_LAW);
        p->over = has_failed(first) || has_failed(second);
        if (p->over) return;
        FUZZ_HOLDS(first == second);
        tame = first == DEM_OK && c->kind == RUN && (features_of(c) & DEM_ENERGY) && !p->extreme &&
               is_tame(&a->w, features_of(c));
    }
    const dem_energy_ledger energy = dem_energy(&a->w);
    const dem_status of_a = apply_call(a, c),
                     of_b = short_of_memory && !runs ? apply_short_of_memory(b, c, fail_at) : apply_call(b, c);
    if (fuzz_traces) {
        fprintf(stderr, "call %2d odd %2d %g: a %d, b %d; %ld spheres, %d walls, step %lld\n", c->kind, c->odd,
                c->value, of_a, of_b, (long)a->w.count, a->w.walls, (long long)a->w.step);
    }
    FUZZ_HOLDS(is_documented(c, of_a, 0) && is_documented(c, of_b, 0));
    /* How soon it is noticed that a sphere is too fast depends on the lists. */
    p->over = has_failed(of_a) || has_failed(of_b);
    if (p->over) return;
    FUZZ_HOLDS(of_a == of_b);
    FUZZ_HOLDS(of_a == DEM_OK || !needed);
    if (of_a != DEM_OK && !runs) FUZZ_HOLDS(digest(&a->w) == before);
    if (of_a == DEM_OK && c->odd >= 0) p->extreme = 1;
    if (fuzz_traces && digest(&a->w) != digest(&b->w)) tell_difference(&a->w, &b->w);
    FUZZ_HOLDS(digest(&a->w) == digest(&b->w));
    note_peaks(&p->most, &a->w), note_peaks(&p->most, &b->w);
    memory_is_bounded(a, &p->most), memory_is_bounded(b, &p->most);
    if (!runs || of_a != DEM_OK) return;
    const dem_energy_ledger now = dem_energy(&a->w);
    energies_are_numbers(&now);
    if (tame && is_tame(&a->w, features_of(c))) ledger_closes(&energy, &now);
}

/* How often each call is drawn. */
static int draw_kind(fuzz_draws *d, int calls) {
    static const int often[] = {ADD_SPHERES, ADD_SPHERES, FILL, SET_MOTION, ADD_LINK, ADD_LINK, RUN, RUN, RUN,
                                RUN,         RUN,         RUN,  RUN,        RUN_LAW,  FIX,      FIX, FIX, SET_MOTION};
    const int n = (int)(sizeof often / sizeof *often) - (calls == CALLS ? 0 : 4), k = fuzz_one_of(d, calls + n);
    return k < calls ? k : often[k - calls];
}

static uint64_t run_program(fuzz_draws *d) {
    const int fuzz_forgeries = getenv("FUZZ_FORGERIES") ? atoi(getenv("FUZZ_FORGERIES")) : 2;
    program p;
    uint64_t hash = 0xcbf29ce484222325u;
    memset(&p, 0, sizeof p);
    const dem_def def = draw_def(d);
    const int kinds = fuzz_seed >= FIRST_WITH_FIXED || d->bytes ? CALLS
                      : fuzz_seed >= FIRST_WITH_BODIES          ? MIDDLE_CALLS
                                                                : OLD_CALLS;
    const int feeds_polyhedra = d->bytes || (kinds == CALLS && fuzz_seed % 3 == 2);
    const int bodies = kinds == OLD_CALLS                              ? 0
                       : !feeds_polyhedra                              ? 1
                       : d->bytes || fuzz_seed >= FIRST_WITH_COMPOUNDS ? 3
                                                                       : 2;
    begin(&p.a, &def, DEM_SKIP_ALL, 1, 0, bodies);
    /* a call draws its arguments in any order */
    const int threads = 1 + fuzz_one_of(d, 3), skip = fuzz_one_of(d, DEM_SKIP_ALL + 1);
    begin(&p.b, &def, skip, threads, 1, bodies);
    const int lasts = fuzz_one_of(d, 1000) == 0; /* many calls, legal ones, and short runs: does memory grow? */
    for (int calls = lasts ? 10000 : 8 + fuzz_one_of(d, 24); calls > 0; calls--) {
        const int kind = draw_kind(d, kinds), hostile = fuzz_one_of(d, 10) == 0 && !lasts;
        call c = draw_call(d, kind, hostile);
        c.most_steps = lasts ? 10 : 1500;
        const int grows = kind == ADD_SPHERES || kind == ADD_CLUMPS || kind == ADD_CONVEX || kind == FILL_IN_MESH ||
                          (kind >= FILL && kind <= FEED_MASS);
        if (grows && spheres_present(&p.a.w) > MOST_SPHERES) continue;
        try_call(&p, d, &c);
        if (fuzz_one_of(d, 6) == 0) readers_change_nothing(&p.a, &c);
        if (p.over) readers_change_nothing(&p.b, &c);
        if (p.over) break;
        if (fuzz_one_of(d, 6) == 0) load_in_place(&p.b, &p.a);
        if (calls % 8 == 0 && !lasts) load_forged(&p.a, &c, fuzz_forgeries);
        fuzz_mix_bits(&hash, digest(&p.a.w));
    }
    if (!p.over) fuzz_mix_bits(&hash, digest(&p.a.w)); /* what is not a number has other bits elsewhere */
    end(&p.a), end(&p.b);
    return hash;
}

FUZZ_PROGRAMS(100, FIRST_WITH_BODIES, 1843, 8785, 11667, 18402, 30776, 100371, 100547, 100889, 105725, 109151, 112296,
              112838, 113162, 113956, 116184, 118699, 123140, 127298, 128703, 131164, 132917, 134508, 135463, 136227,
              138284, 200082, 206089, 209162, 220493, 301639, 101756, 202034)
