/* ---- bytes in and out: one description serves saving, loading and hashing ---- */

typedef struct dem__stream {
    unsigned char *to;         /* saving, or NULL to count */
    const unsigned char *from; /* loading */
    size_t size, at;
    uint64_t hash;
    int loading, failed;
} dem__stream;

static inline void dem__u64(dem__stream *s, uint64_t *v) {
    unsigned char byte[8];
    if (s->loading) {
        if (s->size - s->at < 8) {
            s->failed = 1;
            *v = 0;
            return;
        }
        *v = 0;
        for (int k = 0; k < 8; k++) *v |= (uint64_t)s->from[s->at + (size_t)k] << (8 * k);
    }
    for (int k = 0; k < 8; k++) {
        byte[k] = (unsigned char)(*v >> (8 * k) & 255u);
        s->hash = (s->hash ^ byte[k]) * 0x100000001b3u;
    }
    if (!s->loading && s->to && s->at + 8 <= s->size) memcpy(s->to + s->at, byte, 8);
    s->at += 8;
}

static inline void dem__f64(dem__stream *s, double *v) {
    uint64_t bits;
    memcpy(&bits, v, sizeof bits);
    dem__u64(s, &bits);
    memcpy(v, &bits, sizeof bits);
}

static inline void dem__i64(dem__stream *s, int64_t *v) {
    uint64_t bits = (uint64_t)*v;
    dem__u64(s, &bits);
    *v = (int64_t)bits;
}

static inline void dem__i32(dem__stream *s, int32_t *v) {
    int64_t wide = *v;
    dem__i64(s, &wide);
    if (wide < INT32_MIN || wide > INT32_MAX) s->failed = 1;
    *v = (int32_t)wide;
}

static inline void dem__vecs(dem__stream *s, dem_vec *v, size_t n) {
    for (size_t k = 0; k < n; k++) dem__f64(s, &v[k].x), dem__f64(s, &v[k].y), dem__f64(s, &v[k].z);
}
static inline void dem__ints(dem__stream *s, int *v, size_t n) {
    for (size_t k = 0; k < n; k++) {
        int32_t a = v[k];
        dem__i32(s, &a);
        v[k] = a;
    }
}

static inline void dem__stream_def(dem__stream *s, dem_def *d) {
    int32_t cookie = (int32_t)d->cookie;
    dem__i32(s, &cookie);
    d->cookie = (uint32_t)cookie;
    dem__ints(s, &d->materials, 1), dem__ints(s, &d->threads, 1), dem__ints(s, &d->skip, 1), dem__ints(s, d->periodic, 3);
    dem__f64(s, &d->dt), dem__f64(s, &d->skin);
    dem__vecs(s, &d->gravity, 1), dem__vecs(s, &d->low, 1), dem__vecs(s, &d->high, 1);
    for (int a = 0; a < DEM_MATERIALS_MAX; a++) {
        dem__f64(s, &d->material[a].density), dem__f64(s, &d->material[a].young_modulus), dem__f64(s, &d->material[a].poisson_ratio);
        for (int b = 0; b < DEM_MATERIALS_MAX; b++) {
            dem_pair_def *p = &d->pair[a][b];
            int mode = (int)p->mode;
            dem__f64(s, &p->stiffness), dem__f64(s, &p->tangential_ratio), dem__f64(s, &p->restitution), dem__f64(s, &p->friction);
            dem__f64(s, &p->rolling), dem__f64(s, &p->tangential_damping);
            dem__ints(s, &mode, 1);
            p->mode = mode == (int)DEM_NAIVE ? DEM_NAIVE : DEM_CLIPPED;
        }
    }
}

static inline void dem__stream_wall(dem__stream *s, dem_wall *w) {
    int *flags[] = {&w->kind, &w->material, &w->enabled, &w->inside, &w->profile, &w->circular, &w->slides, &w->asked.drive, &w->solid};
    for (size_t k = 0; k < sizeof flags / sizeof *flags; k++) dem__ints(s, flags[k], 1);
    int32_t groups = (int32_t)(w->groups ^ 0x80000000u);
    dem__i32(s, &groups);
    w->groups = (uint32_t)groups ^ 0x80000000u;
    if (w->solid && w->kind != DEM_MESH) s->failed = 1;
    double *numbers[] = {&w->radius,
                         &w->high_radius,
                         &w->length,
                         &w->aperture,
                         &w->wire,
                         &w->half_x,
                         &w->half_y,
                         &w->asked.frequency,
                         &w->spin,
                         &w->spin_rate,
                         &w->coordinate,
                         &w->rate,
                         &w->rate_change,
                         &w->asked.inertia,
                         &w->asked.load,
                         &w->asked.damping,
                         &w->asked.interval,
                         &w->asked.motion_start,
                         &w->speed_bound,
                         &w->spin_bound,
                         &w->acceleration_bound,
                         &w->side_bound};
    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) dem__f64(s, numbers[k]);
    dem__vecs(s, w->axis, 3), dem__vecs(s, w->asked.rest_axis, 3);
    dem_vec *vectors[] = {
        &w->asked.origin, &w->asked.belt, &w->asked.amplitude, &w->asked.phase, &w->asked.drift, &w->spin_axis, &w->asked.spin_centre,
        &w->position,     &w->velocity,   &w->acceleration,    &w->force,       &w->torque,      &w->impulse};
    for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++) dem__vecs(s, vectors[k], 1);
}

/* Particles present and contacts; remap__[i] must be the index among those present. */
static inline void dem__stream_state(dem__stream *s, dem_world *w, const int32_t *remap, int with_forces) {
    dem__bodies *bodies = &w->engine->bodies;
    dem__contacts *contacts = &w->engine->contacts;
    dem__links *links = &w->engine->links;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        dem_particle *p = &w->particle[i];
        dem__vecs(s, &p->x, 1), dem__vecs(s, &p->v, 1), dem__vecs(s, &p->a, 1), dem__vecs(s, &p->spin, 1),
            dem__vecs(s, &w->spin_rate[i], 1);
        dem__f64(s, &p->radius), dem__f64(s, &p->mass);
        for (int a = 0; a < 6; a++) dem__f64(s, &bodies->load[i][a]);
        dem__i64(s, &w->particle[i].origin);
        dem__u64(s, &w->id[i]);
        dem__i32(s, &w->material[i]), dem__i32(s, &w->group[i]);
        for (int a = 0; a < 6; a++) {
            if (links->on) dem__f64(s, &bodies->external[i][a]);
            else if (s->loading) bodies->external[i][a] = bodies->load[i][a];
        }
        for (int a = 0; a < 6 && links->on && with_forces; a++) dem__f64(s, &links->evaluated_at[i][a]);
        if (links->on) dem__i32(s, &links->is_loaded[i]);
    }
    for (ptrdiff_t k = 0; k < links->count; k++) {
        int32_t i = remap ? remap[links->i[k]] : links->i[k], j = links->j[k];
        if (remap && j >= 0) j = remap[j];
        dem__i32(s, &i), dem__i32(s, &j), dem__i32(s, &links->element[k]);
        if (s->loading) links->i[k] = i, links->j[k] = j;
        for (int a = 0; a < links->states; a++) dem__f64(s, &links->state[a][k]);
    }
    DEM__EACH_CONTACT(w, c) {
        int32_t i = remap ? remap[contacts->i[c]] : contacts->i[c], j = contacts->j[c];
        if (remap && j >= 0) j = remap[j];
        dem__i32(s, &i), dem__i32(s, &j), dem__i32(s, &contacts->element[c]);
        if (s->loading) contacts->i[c] = i, contacts->j[c] = j;
        dem__f64(s, &contacts->gap[c]), dem__f64(s, &contacts->force[c]);
        for (int a = 0; a < contacts->states; a++) dem__f64(s, &contacts->state[a][c]);
        if (!with_forces) continue;
        for (int a = 0; w->engine->walls.touch_keepers && a < 4; a++) dem__f64(s, &contacts->touch[a][c]);
        for (int a = 0; a < 9; a++) dem__f64(s, &contacts->wrench[a][c]);
        if (w->engine->ledger.on) {
            dem__f64(s, &contacts->elastic[c]);
            for (int a = 0; a < 3; a++) dem__f64(s, &contacts->power[a][c]);
        }
    }
}

static inline void dem__quaternions(dem__stream *s, dem_quaternion *q, size_t n) {
    for (size_t k = 0; k < n; k++) dem__f64(s, &q[k].w), dem__f64(s, &q[k].x), dem__f64(s, &q[k].y), dem__f64(s, &q[k].z);
}

/* One rigid body; remap[i], without one i, is the index of particle i. */
static inline void dem__stream_body(dem__stream *s, dem_world *w, dem__rigid *r, const int32_t *remap) {
    int32_t first = remap && !s->loading ? remap[r->first] : r->first;
    dem__i32(s, &first), dem__i32(s, &r->pieces);
    if (s->loading) r->first = first;
    dem__vecs(s, &r->x, 1), dem__vecs(s, &r->v, 1), dem__vecs(s, &r->a, 1), dem__vecs(s, &r->momentum, 1), dem__vecs(s, &r->torque, 1);
    dem__quaternions(s, &r->turn, 1), dem__quaternions(s, &r->frame, 1);
    dem__vecs(s, &r->moments, 1), dem__f64(s, &r->mass);
    if (s->failed || r->first < 0 || r->pieces < 1 || r->first > w->count - r->pieces) {
        s->failed = 1;
        return;
    }
    for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++) {
        dem__vecs(s, &w->engine->bodies.offset[i], 1), dem__vecs(s, &w->engine->bodies.arm[i], 1);
    }
}

/* Rigid bodies, if there are any, in the order of their particles. */
static inline void dem__stream_bodies(dem__stream *s, dem_world *w, const int32_t *remap) {
    const dem__bodies *bodies = &w->engine->bodies;
    int64_t present = 0;
    for (ptrdiff_t k = 0; k < bodies->rigid_count; k++) present += w->alive[bodies->rigid[k].first] != 0;
    if (present == 0) return;
    dem__i64(s, &present);
    for (ptrdiff_t k = 0; k < bodies->rigid_count; k++) {
        if (!w->alive[bodies->rigid[k].first]) continue;
        dem__rigid copy = bodies->rigid[k];
        dem__stream_body(s, w, &copy, remap);
    }
}

/* Loads them, if a save goes on. */
static inline dem_status dem__load_bodies(dem__stream *s, dem_world *w) {
    dem__bodies *bodies = &w->engine->bodies;
    int64_t present = 0;
    if (s->failed || s->size - s->at <= 8) return DEM_OK;
    dem__i64(s, &present);
    if (present < 1 || present > w->count || (size_t)present > s->size / 200) return DEM_BAD_DATA;
    if (!dem__reserve_bodies(w, (ptrdiff_t)present, 0)) return DEM_OUT_OF_MEMORY;
    for (ptrdiff_t k = 0; k < present && !s->failed; k++) {
        dem__rigid *r = &bodies->rigid[bodies->rigid_count++];
        memset(r, 0, sizeof *r);
        dem__stream_body(s, w, r, NULL);
        const dem_vec m = r->moments;
        const double q = r->turn.w * r->turn.w + r->turn.x * r->turn.x + r->turn.y * r->turn.y + r->turn.z * r->turn.z;
        if (s->failed || !dem__positive(m.x) || !dem__positive(m.y) || !dem__positive(m.z) || !dem__positive(r->mass) ||
            !(fabs(q - 1.0) < 1e-6))
            return DEM_BAD_DATA;
        for (ptrdiff_t i = r->first; i < r->first + r->pieces; i++) {
            if (bodies->rigid_of[i] != 0 || w->particle[i].origin != w->particle[r->first].origin || w->particle[i].mass != r->mass)
                return DEM_BAD_DATA;
            bodies->rigid_of[i] = (int32_t)bodies->rigid_count;
        }
    }
    return DEM_OK;
}

static inline void dem__number_present(const dem_world *w) {
    int32_t n = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) w->engine->scratch.index[i] = w->alive[i] ? n++ : -1;
}

DEM_API uint64_t dem_hash(const dem_world *world) {
    dem__stream s;
    memset(&s, 0, sizeof s);
    s.hash = 0xcbf29ce484222325u;
    if (!world || !world->def.allocator.fn) return s.hash;
    dem_world w = *world; /* shares the arrays; a stream that saves changes none of them */
    dem__number_present(&w);
    dem__i64(&s, &w.step);
    for (int k = 0; k < w.walls; k++) {
        if (w.wall[k].asked.drive >= DEM_FORCE_CONTROLLED) dem__f64(&s, &w.wall[k].coordinate), dem__f64(&s, &w.wall[k].rate);
    }
    dem__stream_state(&s, &w, w.engine->scratch.index, 0);
    dem__stream_bodies(&s, &w, w.engine->scratch.index);
    return s.hash;
}

static inline void dem__stream_chunks(dem__stream *s, dem_world *w, int64_t live, int64_t present) {
    dem__contacts *contacts = &w->engine->contacts;
    const int64_t all = live + DEM__BLOCK;
    ptrdiff_t first = 0;
    dem__ints(s, &contacts->chunk_count, 1);
    if (contacts->chunk_count < 1 || contacts->chunk_count > DEM__CHUNKS) s->failed = 1;
    for (int q = 0; q < contacts->chunk_count && !s->failed; q++) {
        dem__chunk *in = &contacts->chunk[q];
        int64_t of = in->count, room = in->capacity;
        int32_t from = in->first_particle;
        if (!s->loading && from > 0) from = dem__remapped(w, from);
        dem__i64(s, &of), dem__i64(s, &room), dem__i32(s, &from);
        if (of < 0 || of > live || room < 0 || room > 64 * (all + present) || (q < contacts->chunk_count - 1 && of > room)) s->failed = 1;
        if (!s->loading || s->failed) continue;
        in->first = first, in->count = (ptrdiff_t)of, in->capacity = (ptrdiff_t)room,
        in->first_particle = q < contacts->chunk_count - 1 ? from : 0;
        first += in->capacity;
        live -= of;
    }
    if (s->loading && live != 0) s->failed = 1;
}

static inline void dem__stream_head(dem__stream *s, dem_world *w, int64_t *present) {
    dem__run *run = &w->engine->run;
    dem__contacts *contacts = &w->engine->contacts;
    dem__ledger *ledger = &w->engine->ledger;
    uint64_t magic = 0x0a1a64656d52u, version = DEM__FORMAT;
    dem__u64(s, &magic), dem__u64(s, &version);
    if (magic != 0x0a1a64656d52u || version != DEM__FORMAT) s->failed = 1;
    dem__stream_def(s, &w->def);
    dem__i64(s, &w->step), dem__f64(s, &w->time), dem__f64(s, &run->start_time), dem__i64(s, &run->start_step), dem__f64(s, &w->owed);
    dem__u64(s, &w->engine->bodies.next_id);
    dem__i64(s, &w->passed_total);
    dem__i64(s, &w->particle_steps), dem__i64(s, &w->contact_steps), dem__i64(s, &w->looks), dem__i64(s, &w->rebuilds);
    const int64_t counts[] = {w->step, run->start_step, w->particle_steps, w->contact_steps, w->looks, w->rebuilds};
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) s->failed |= s->loading && !(counts[k] >= 0 && counts[k] < INT64_MAX / 4);
    int *flags[] = {&w->walls,
                    &run->needs_forces,
                    &ledger->on,
                    &ledger->started,
                    &ledger->counts,
                    &contacts->has_history,
                    &w->engine->bodies.loads_on,
                    &contacts->states,
                    &w->engine->links.on,
                    &w->engine->links.states};
    for (size_t k = 0; k < sizeof flags / sizeof *flags; k++) dem__ints(s, flags[k], 1);
    if (w->walls < 0 || w->walls > DEM_WALLS_MAX || contacts->states < 0 || contacts->states > DEM_STATE_MAX) s->failed = 1;
    if (w->engine->links.states < 0 || w->engine->links.states > DEM_STATE_MAX) s->failed = 1;
    dem__f64(s, &w->engine->links.interval), dem__f64(s, &w->engine->links.near);
    if (!s->failed && s->loading && !dem__grow_walls(w, w->walls)) {
        w->status = DEM_OUT_OF_MEMORY;
        s->failed = 1;
    }
    dem__f64(s, &ledger->paused_error);
    for (int k = 0; k < w->walls && !s->failed; k++) dem__stream_wall(s, &w->wall[k]);
    dem_energy_ledger *l = &ledger->sums;
    double *sums[] = {&l->normal_loss, &l->sliding_loss, &l->rolling_loss, &l->wall_work,       &l->link_work,       &l->external_work,
                      &l->added,       &l->removed,      &l->start,        &l->start_potential, &l->added_potential, &l->removed_potential};
    for (size_t k = 0; k < sizeof sums / sizeof *sums; k++) dem__f64(s, sums[k]);
    int64_t live = contacts->count, passed = w->passed_count, links = w->engine->links.count;
    dem__i64(s, present), dem__i64(s, &live), dem__i64(s, &passed), dem__i64(s, &links);
    if (links < 0 || links > INT32_MAX / 4 || !dem__not_negative(w->engine->links.near) || !dem__not_negative(w->engine->links.interval))
        s->failed = 1;
    if (live < 0 || passed < 0 || *present < 0 || live > INT32_MAX / 4 || *present > INT32_MAX / 4 || passed > INT32_MAX) s->failed = 1;
    dem__stream_chunks(s, w, live, *present);
    contacts->count = (ptrdiff_t)live;
    w->passed_count = (ptrdiff_t)passed;
    w->engine->links.count = (ptrdiff_t)links;
}

static inline void dem__stream_passed(dem__stream *s, dem_world *w) {
    for (ptrdiff_t k = 0; k < w->passed_count && !s->failed; k++) {
        dem_passed *p = &w->passed[k];
        dem__f64(s, &p->time), dem__f64(s, &p->diameter), dem__vecs(s, &p->position, 1), dem__vecs(s, &p->velocity, 1);
        dem__u64(s, &p->id), dem__i32(s, &p->group), dem__i32(s, &p->exit);
    }
}

/* The triangles of meshes, which a tree is made from anew. */
static inline dem_status dem__stream_mesh(dem__stream *s, dem_wall *a, const dem_allocator *memory) {
    int64_t vertices = s->loading ? 0 : a->tree->vertices, triangles = s->loading ? 0 : a->tree->triangles;
    dem_vec *vertex = s->loading ? NULL : a->tree->vertex;
    int32_t *corner = s->loading ? NULL : a->tree->corner;
    size_t bytes = 0;
    dem_status status = DEM_OK;
    dem__i64(s, &vertices), dem__i64(s, &triangles);
    if (s->loading) {
        const int64_t room = (int64_t)((s->size - s->at) / 24);
        if (s->failed || vertices < 1 || triangles < 1 || vertices > room || triangles > room - vertices) return DEM_BAD_DATA;
        bytes = (size_t)vertices * sizeof *vertex + 3 * (size_t)triangles * sizeof *corner;
        vertex = (dem_vec *)memory->fn(memory->user, NULL, 0, bytes);
        if (!vertex) return DEM_OUT_OF_MEMORY;
        corner = (int32_t *)(void *)(vertex + vertices);
    }
    dem__vecs(s, vertex, (size_t)vertices);
    for (int64_t k = 0; k < 3 * triangles; k++) dem__i32(s, &corner[k]);
    if (!s->loading) return DEM_OK;
    for (int64_t k = 0; k < vertices; k++) {
        if (!(fabs(vertex[k].x) < 1e50 && fabs(vertex[k].y) < 1e50 && fabs(vertex[k].z) < 1e50)) s->failed = 1;
    }
    for (int64_t k = 0; k < 3 * triangles; k++) {
        if (corner[k] < 0 || corner[k] >= vertices) s->failed = 1;
    }
    if (s->failed) status = DEM_BAD_DATA;
    else a->tree = dem__make_tree(memory, (ptrdiff_t)vertices, vertex, (ptrdiff_t)triangles, corner, &status);
    memory->fn(memory->user, vertex, bytes, 0);
    return status == DEM_BAD_ARGUMENT ? DEM_BAD_DATA : status;
}

static inline dem_status dem__stream_meshes(dem__stream *s, dem_world *w) {
    for (int k = 0; k < w->walls; k++) {
        if (w->wall[k].kind != DEM_MESH) continue;
        const dem_status status = dem__stream_mesh(s, &w->wall[k], &w->def.allocator);
        if (status != DEM_OK) return status;
    }
    return DEM_OK;
}

DEM_API size_t dem_save(const dem_world *world, void *buffer, size_t capacity) {
    dem__stream s;
    if (!world || !world->def.allocator.fn) return 0;
    for (int pass = 0; pass < 2; pass++) {
        dem_world w = *world;
        int64_t present = w.count - w.engine->bodies.dropped;
        uint64_t check;
        memset(&s, 0, sizeof s);
        s.hash = 0xcbf29ce484222325u;
        s.to = pass && buffer ? (unsigned char *)buffer : NULL;
        s.size = capacity;
        dem__number_present(&w);
        dem__stream_head(&s, &w, &present);
        dem__stream_state(&s, &w, w.engine->scratch.index, 1);
        dem__stream_passed(&s, &w);
        dem__stream_meshes(&s, &w);
        dem__stream_bodies(&s, &w, w.engine->scratch.index);
        check = s.hash;
        dem__u64(&s, &check);
        if (s.at > capacity) break; /* too small: nothing is written */
    }
    return s.at;
}

/* Every index and number in loaded data that the code relies on. */
static inline int dem__loaded_is_sound(const dem_world *w) {
    const dem__contacts *contacts = &w->engine->contacts;
    const dem__links *links = &w->engine->links;
    ptrdiff_t n = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!dem__positive(w->particle[i].radius) || !dem__positive(w->particle[i].mass) || w->material[i] < 0 ||
            w->material[i] >= w->def.materials || w->particle[i].origin > w->step || w->particle[i].origin < 0)
            return 0;
        if (i > 0 && w->id[i] <= w->id[i - 1]) return 0;
    }
    DEM__EACH_CONTACT(w, c) {
        const int32_t i = contacts->i[c], j = contacts->j[c];
        if (i < 0 || i >= w->count || j >= w->count || j < -w->walls || (j >= 0 && j <= i)) return 0;
        if (j < 0 && w->wall[-1 - j].kind == DEM_MESH && (contacts->element[c] < 0 || contacts->element[c] >= DEM__NUMBERS)) return 0;
        if (w->particle[i].origin != w->step || (j >= 0 && w->particle[j].origin != w->step)) return 0;
        contacts->slots[n++] = (int32_t)c;
    }
    dem__sort(w, contacts->slots, n); /* none is there twice */
    for (ptrdiff_t c = 1; c < n; c++) {
        if (!dem__before(w, contacts->slots[c - 1], contacts->slots[c])) return 0;
    }
    for (ptrdiff_t k = 0; k < links->count; k++) {
        const int32_t i = links->i[k], j = links->j[k];
        if (i < 0 || i >= w->count || j >= w->count || j < -w->walls || i == j) return 0;
    }
    for (int k = 0; k < w->walls; k++) {
        const dem_wall *a = &w->wall[k];
        if (a->material < 0 || a->material >= w->def.materials || a->kind < DEM_PLANE || a->kind > DEM_MESH) return 0;
        if (a->kind == DEM_SCREEN && !dem__is_deck(a)) return 0;
        if (a->kind == DEM_CONE && !(a->length > 0.0 && a->radius + a->high_radius > 0.0)) return 0;
        if (a->asked.drive < DEM_KINEMATIC || a->asked.drive > DEM_TORQUE_CONTROLLED ||
            (a->asked.drive == DEM_PRESCRIBED && !(a->asked.interval > 0.0)))
            return 0;
        if (a->asked.drive >= DEM_FORCE_CONTROLLED && !(a->asked.inertia > 0.0)) return 0;
    }
    return 1;
}

DEM_API dem_status dem_load(dem_world *world, const void *buffer, size_t size, const dem_allocator *allocator) {
    dem_world *w = world;
    dem__stream s;
    int64_t present = 0;
    uint64_t check, found = 0;
    if (!w || !buffer) return DEM_BAD_ARGUMENT;
    memset(w, 0, sizeof *w);
    memset(&s, 0, sizeof s);
    s.hash = 0xcbf29ce484222325u;
    s.from = (const unsigned char *)buffer;
    s.size = size;
    s.loading = 1;
    dem_allocator memory;
    memory.fn = dem__default_allocator;
    memory.user = NULL;
    if (allocator) memory = *allocator;
    w->def.allocator = memory;
    if (!dem__make_engine(w)) {
        memset(w, 0, sizeof *w);
        return DEM_OUT_OF_MEMORY;
    }
    dem__stream_head(&s, w, &present);
    const size_t per_particle = 27 * 8, per_contact = 14 * 8;
    if (s.failed || dem__bad_field(&w->def) || (size_t)present > size / per_particle ||
        (size_t)w->engine->contacts.count > size / per_contact || (size_t)w->passed_count > size / 80 ||
        (size_t)w->engine->links.count > size / 24) {
        const dem_status why = w->status == DEM_OUT_OF_MEMORY ? DEM_OUT_OF_MEMORY : DEM_BAD_DATA;
        if (!w->wall) w->walls = 0;
        dem_free(w);
        return why;
    }
    dem__array list[DEM__ARRAYS_MAX];
    ptrdiff_t live = w->engine->contacts.count, passed = w->passed_count, links = w->engine->links.count;
    int enough;
    w->engine->contacts.count = w->passed_count = w->engine->links.count = 0;
    for (int k = 0; k < w->walls; k++) {
        w->engine->walls.meshes += w->wall[k].kind == DEM_MESH;
        w->engine->walls.touch_keepers += w->wall[k].kind == DEM_MESH || w->wall[k].kind == DEM_CONE;
        w->engine->walls.controls |= w->wall[k].asked.drive >= DEM_FORCE_CONTROLLED;
    }
    enough = dem__grow_group(w, list, dem__particle_arrays(w, list), &w->engine->bodies.block, &w->engine->bodies.bytes,
                             &w->engine->bodies.capacity, (ptrdiff_t)present + 1);
    enough = enough && dem__grow_contacts(w, dem__next_slot(w) + 1);
    enough = enough && (links == 0 || dem__grow_group(w, list, dem__link_arrays(w, list), &w->engine->links.block, &w->engine->links.bytes,
                                                      &w->engine->links.capacity, links));
    if (enough && passed > 0) {
        w->passed = (dem_passed *)memory.fn(memory.user, NULL, 0, (size_t)passed * sizeof *w->passed);
        enough = w->passed != NULL;
        w->engine->bodies.passed_capacity = passed;
    }
    if (!enough) {
        dem_free(w);
        return DEM_OUT_OF_MEMORY;
    }
    w->count = (ptrdiff_t)present;
    w->engine->run.keeps_wrenches = 1;
    w->engine->contacts.count = live;
    w->passed_count = passed;
    w->engine->links.count = links;
    for (ptrdiff_t i = 0; i < w->count; i++) w->alive[i] = 1, w->engine->walls.first_contact[i] = w->engine->links.first_link[i] = -1;
    dem__stream_state(&s, w, NULL, 1);
    dem__stream_passed(&s, w);
    dem_status meshes = dem__stream_meshes(&s, w);
    if (meshes == DEM_OK) meshes = dem__load_bodies(&s, w);
    check = s.hash;
    dem__u64(&s, &found);
    if (meshes == DEM_OUT_OF_MEMORY) {
        dem_free(w);
        return meshes;
    }
    if (meshes != DEM_OK || s.failed || found != check || s.at != size || !dem__loaded_is_sound(w)) {
        dem_free(w);
        return DEM_BAD_DATA;
    }
    w->engine->run.dt = w->def.dt;
    w->engine->run.has_periodic = w->def.periodic[0] | w->def.periodic[1] | w->def.periodic[2];
    w->engine->run.needs_lists = 1;
    dem__find_links(w);
    DEM__EACH_CONTACT(w, c) {
        dem__activate(w, w->engine->contacts.i[c]);
        if (w->engine->contacts.j[c] >= 0) dem__activate(w, w->engine->contacts.j[c]);
        else {
            w->engine->contacts.wall_next[c] = w->engine->walls.first_contact[w->engine->contacts.i[c]];
            w->engine->walls.first_contact[w->engine->contacts.i[c]] = (int32_t)c;
        }
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dem__set_inverse_mass(w, i);
        if (dem__is_loaded(w, i) && !w->engine->bodies.activity[i]) {
            dem__wake(w, i);
            dem__set_mass_share(w, i);
        }
    }
    return DEM_OK;
}
