/* -------------------------------------------------------------------------------------------------- >>step */

static inline void dem__drop(dem_world *w, ptrdiff_t i, int wall) {
    double tau = (double)(w->step + 1 - w->particle[i].origin) * w->dt__;
    dem_vec x = dem__at(w, i, tau), v = dem__velocity_at(w, i, tau);
    if (w->alive[i] < 0) { /* it passed another exit in the same step: the first of them counts, whatever the order of the looks */
        ptrdiff_t k = w->passed_count - 1;
        while (w->passed[k].id != w->id[i]) k--;
        if (wall < w->passed[k].exit) w->passed[k].exit = wall;
        return;
    }
    if (w->passed_count >= w->passed_capacity__) {
        ptrdiff_t larger = w->passed_capacity__ * 2 + 256;
        dem_passed *fresh = (dem_passed *)w->def.allocator.fn(w->def.allocator.user, w->passed,
                                                              (size_t)w->passed_capacity__ * sizeof *fresh, (size_t)larger * sizeof *fresh);
        if (!fresh) {
            w->status = DEM_OUT_OF_MEMORY;
            return;
        }
        w->passed = fresh;
        w->passed_capacity__ = larger;
    }
    /* in the order of ids, whatever the order of the looks in this step */
    double time = w->start_time__ + (double)(w->step + 1 - w->start_step__) * w->dt__;
    ptrdiff_t at = w->passed_count++;
    for (; at > 0 && w->passed[at - 1].time == time && w->passed[at - 1].id > w->id[i]; at--) w->passed[at] = w->passed[at - 1];
    dem_passed *p = &w->passed[at];
    p->time = time;
    p->diameter = 2.0 * w->particle[i].radius;
    p->position = x;
    p->velocity = v;
    p->id = w->id[i];
    p->group = w->group[i];
    p->exit = wall;
    w->alive[i] = -1; /* leaves at the end of the step */
    w->leaving__ = 1;
}

static inline void dem__unlist_link(dem_world *w, int32_t k, int32_t i, int32_t replacement) {
    int32_t *at = &w->link_head__[i];
    while (*at != k) at = w->link_i__[*at] == i ? &w->link_next_i__[*at] : &w->link_next_j__[*at];
    *at = replacement >= 0 ? replacement : dem__next_link(w, k, i);
}

/* The last of a particle's links by slot: the order of its list depends on what has happened. */
static inline int32_t dem__last_link(const dem_world *w, ptrdiff_t i) {
    int32_t last = -1;
    for (int32_t k = w->link_head__[i]; k >= 0; k = dem__next_link(w, k, i)) last = k > last ? k : last;
    return last;
}

/* Ends a link; the last one takes its slot. Its force stays until links are evaluated next. */
static inline void dem__cut_link(dem_world *w, int32_t k) {
    const int32_t i = w->link_i__[k], j = w->link_j__[k], last = (int32_t)w->link_count__ - 1;
    if (w->link_law__ && w->link_law__->ended) w->link_law__->ended(w, k, w->user);
    dem__unlist_link(w, k, i, -1);
    if (j >= 0) {
        const int32_t p = dem__near_pair(w, i, j);
        dem__mark_link(w, p, 0);
        dem__unlist_link(w, k, j, -1);
    }
    w->link_count__ = last;
    if (k == last) return;
    dem__unlist_link(w, last, w->link_i__[last], k);
    if (w->link_j__[last] >= 0) dem__unlist_link(w, last, w->link_j__[last], k);
    dem__array list[DEM__ARRAYS_MAX];
    const int n = dem__link_arrays(w, list);
    for (int a = 0; a < n; a++) {
        char *base;
        memcpy(&base, list[a].address, sizeof base);
        memcpy(base + (size_t)k * list[a].size, base + (size_t)last * list[a].size, list[a].size);
    }
}

/* An active particle that dem__watch shall see to. */
DEM_INLINE void dem__unsettle(dem_world *w, ptrdiff_t i) {
    if (w->is_active__[i] != 1) return;
    w->is_active__[i] = 2;
    w->unsettled__[w->unsettled_count__++] = (int32_t)i;
}

/* Takes particle i out of all lists; its slot goes with the next rebuild. */
static inline void dem__forget(dem_world *w, ptrdiff_t i) {
    if (w->ledger_on__) {
        w->ledger__.link_work += dem__link_work(w, i);
        w->ledger__.removed += dem__kinetic(w, i) + dem__rotational(w, i) + dem__potential(w, i);
        w->ledger__.removed_potential += dem__potential(w, i);
    }
    while (w->link_head__[i] >= 0) dem__cut_link(w, dem__last_link(w, i));
    w->alive[i] = 0;
    w->dropped__++;
    dem__unsettle(w, i);
    if (w->stale__) return;
    for (int32_t a = w->adjacent_start__[i]; a < w->adjacent_start__[i + 1]; a++) {
        dem__stop_timer(&w->pair_timers__, w->adjacent__[2 * a]);
    }
    for (int k = 0; k < w->walls; k++) dem__stop_timer(&w->wall_timers__, (int32_t)i * w->walls + k);
}

static inline void dem__bury(dem_world *w, int64_t step, int all);

/* After others have been taken out: whoever touched nothing else is in flight, without the force of then. */
static inline void dem__let_go(dem_world *w) {
    for (ptrdiff_t k = 0; k < w->active_count__; k++) {
        if (!w->touching[w->active__[k]]) dem__free_acceleration(w, w->active__[k]);
    }
}

/* Ends the contacts of those who have been taken out. */
static inline void dem__leave_alone(dem_world *w) {
    DEM__EACH(w, c) {
        const int32_t j = w->live_j__[c];
        if (!w->alive[w->live_i__[c]] || (j >= 0 && !w->alive[j])) w->live_ended__[c] = 1;
    }
    w->stale__ = w->fresh__ = 1;
    dem__bury(w, w->step, 1);
    dem__let_go(w);
}

DEM_API dem_status dem_remove(dem_world *world, ptrdiff_t i) {
    dem_world *w = world;
    if (!dem__is_present(w, i)) return DEM_BAD_ARGUMENT;
    dem__forget(w, i);
    dem__leave_alone(w);
    return DEM_OK;
}

DEM_API dem_status dem_set_links(dem_world *world, const dem_law *law, dem_kernel_fn kernel, double interval, double near) {
    dem_world *w = world;
    if (!w || !w->def.allocator.fn || !law || !law->force || !kernel || !dem__positive(interval) || !dem__not_negative(near))
        return DEM_BAD_ARGUMENT;
    if (law->states < 0 || law->states > DEM_STATE_MAX || law->vectors < 0 || 3 * law->vectors > law->history || law->history > law->states)
        return DEM_BAD_ARGUMENT;
    if (w->link_count__ > 0 && law->states != w->link_states__) return DEM_LAW_MISMATCH;
    w->links_on__ = 1;
    w->link_law__ = law;
    w->link_kernel__ = kernel;
    w->link_interval__ = interval;
    if (w->link_near__ != near) w->stale__ = 1;
    w->link_near__ = near;
    if (law->states != w->link_states__) { /* other arrays: a new block when there is a link */
        if (w->link_block__) w->def.allocator.fn(w->def.allocator.user, w->link_block__, w->link_bytes__, 0);
        w->link_block__ = NULL;
        w->link_capacity__ = 0;
        w->link_states__ = law->states;
    }
    dem__set_stride(w);
    return DEM_OK;
}

DEM_API dem_status dem_add_link(dem_world *world, ptrdiff_t i, ptrdiff_t j, int32_t element, const double *state) {
    dem_world *w = world;
    if (!dem__is_present(w, i) || !w->link_law__ || (!state && w->link_states__ > 0) || i == j) return DEM_BAD_ARGUMENT;
    if (j >= 0 ? !dem__is_present(w, j) : -1 - j >= w->walls) return DEM_BAD_ARGUMENT;
    if (w->link_count__ + 1 > w->link_capacity__) {
        dem__array list[DEM__ARRAYS_MAX];
        if (w->link_count__ > INT32_MAX / 2 || !dem__grow_group(w, list, dem__link_arrays(w, list), &w->link_block__, &w->link_bytes__,
                                                                &w->link_capacity__, w->link_count__ + 1))
            return DEM_OUT_OF_MEMORY;
    }
    const int32_t k = (int32_t)w->link_count__++;
    w->link_i__[k] = (int32_t)i, w->link_j__[k] = (int32_t)j, w->link_element__[k] = element;
    for (int a = 0; a < w->link_states__; a++) w->link_state__[a][k] = state[a];
    for (int a = 0; a < 9; a++) w->link_out__[a][k] = 0.0;
    w->link_gap__[k] = 0.0;
    w->link_ended__[k] = 0;
    dem__list_link(w, k);
    return DEM_OK;
}

/* Order of contacts: by i, the last first, then j (walls last), then element. */
DEM_INLINE int dem__before(const dem_world *w, int32_t a, int32_t b) {
    if (w->live_i__[a] != w->live_i__[b]) return w->live_i__[a] > w->live_i__[b];
    int64_t ja = w->live_j__[a], jb = w->live_j__[b];
    ja = ja < 0 ? INT32_MAX - ja : ja, jb = jb < 0 ? INT32_MAX - jb : jb;
    if (ja != jb) return ja < jb;
    return w->live_element__[a] < w->live_element__[b];
}

static inline void dem__sift(const dem_world *w, int32_t *heap, ptrdiff_t root, ptrdiff_t n) {
    for (;;) {
        ptrdiff_t child = 2 * root + 1;
        if (child >= n) return;
        if (child + 1 < n && dem__before(w, heap[child], heap[child + 1])) child++;
        if (!dem__before(w, heap[root], heap[child])) return;
        int32_t t = heap[root];
        heap[root] = heap[child], heap[child] = t;
        root = child;
    }
}

static inline void dem__sort(const dem_world *w, int32_t *slots, ptrdiff_t n) {
    for (ptrdiff_t k = n / 2 - 1; k >= 0; k--) dem__sift(w, slots, k, n);
    for (ptrdiff_t k = n - 1; k > 0; k--) {
        int32_t t = slots[0];
        slots[0] = slots[k], slots[k] = t;
        dem__sift(w, slots, 0, k);
    }
}

/* The slots of contacts that have ended, into slots__: of those that the last step marked, or of all. */
static inline ptrdiff_t dem__list_ended(dem_world *w, int all) {
    ptrdiff_t n = 0;
    for (const dem__section *in = w->section__; in < w->section__ + w->sections__; in++) {
        for (ptrdiff_t k = 0; k < (all ? in->live : in->marked); k++) {
            const ptrdiff_t c = all ? in->first + k : w->slots__[in->first + k];
            if (w->live_ended__[c]) w->slots__[n++] = (int32_t)c;
        }
    }
    return n;
}

/* One element of an array, most often a double or 32 bits. */
DEM_INLINE void dem__copy(char *to, const char *from, size_t size) {
    if (size == 8) memcpy(to, from, 8);
    else if (size == 4) memcpy(to, from, 4);
    else *to = *from;
}

/* The n elements of an array that `from` lists, one after the other. */
static inline void dem__pick(char *to, const char *base, size_t size, const int32_t *from, ptrdiff_t n) {
    for (ptrdiff_t k = 0; k < n; k++) dem__copy(to + (size_t)k * size, base + (size_t)from[k] * size, size);
}

/* What the slots hold that slots__ lists, one after the other into the slots of sections: every parts-th array, from `first` on. */
static inline void dem__arrange_part(dem_world *w, const dem__section *section, int sections, const dem__array *list, int arrays, int first,
                                     int parts) {
    char *scratch = (char *)w->live_handed__ + (size_t)first * (size_t)w->live_capacity__ * sizeof(double);
    ptrdiff_t n = 0;
    for (int q = 0; q < sections; q++) n += section[q].live;
    for (int a = first; a < arrays; a += parts) {
        const size_t size = list[a].size;
        const char *from = scratch;
        char *base;
        memcpy(&base, list[a].address, sizeof base);
        dem__pick(scratch, base, size, w->slots__, n);
        for (int q = 0; q < sections; q++) {
            const size_t bytes = (size_t)section[q].live * size;
            memcpy(base + (size_t)section[q].first * size, from, bytes);
            from += bytes;
        }
    }
}
static inline void dem__arrange(dem_world *w, ptrdiff_t n, const dem__section *section, int sections, const dem__array *list, int arrays) {
    const int parts = dem__parts_of(w, n, (int)(sizeof(dem__handed) / sizeof(double))); /* an array to work in each */
    int q;
    if (parts == 1) {
        dem__arrange_part(w, section, sections, list, arrays, 0, 1);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(static, 1) num_threads(parts)
#endif
    for (q = 0; q < parts; q++) dem__arrange_part(w, section, sections, list, arrays, q, parts);
}

DEM_INLINE void dem__divide(dem_world *w, ptrdiff_t i) { w->share__[i] = w->touching[i] > 1 ? 1.0 / (double)w->touching[i] : 1.0; }

DEM_INLINE void dem__activate(dem_world *w, ptrdiff_t i) {
    w->touching[i]++;
    dem__divide(w, i);
    if (w->is_active__[i]) return;
    w->is_active__[i] = 1;
    w->active__[w->active_count__++] = (int32_t)i;
}

static inline void dem__fold_constants(dem_world *w, ptrdiff_t c, const dem_law *law, int features) {
    dem_birth b;
    dem__kind kind;
    const ptrdiff_t i = w->live_i__[c], j = w->live_j__[c];
    const double inertia = dem__inertia(w, i);
    int same = w->kinds__ > DEM_KINDS_MAX ? w->kinds__ : 0; /* more than fit: nobody looks */
    memset(&b, 0, sizeof b);
    memset(&kind, 0, sizeof kind);
    b.def = &w->def;
    b.features = features;
    b.material_i = w->material[i];
    b.radius_i = w->particle[i].radius;
    if (j >= 0) {
        double other = dem__inertia(w, j);
        b.material_j = w->material[j];
        b.radius_j = w->particle[j].radius;
        b.mass = w->particle[i].mass * w->particle[j].mass / (w->particle[i].mass + w->particle[j].mass);
        b.inertia = inertia * other / (inertia + other);
    } else {
        dem__touch touch;
        dem__touch_element(&w->wall[-1 - j], w->particle[i].x, w->particle[i].radius, w->live_element__[c], &touch);
        b.material_j = w->wall[-1 - j].material;
        b.curvature = w->wall[-1 - j].kind == DEM_CONE ? w->live_place__[0][c] : touch.curvature;
        b.mass = w->particle[i].mass;
        b.inertia = inertia;
    }
    b.pair = b.material_i < b.material_j ? &w->def.pair[b.material_i][b.material_j] : &w->def.pair[b.material_j][b.material_i];
    b.user = w->user;
    b.damping_ratio = w->damping_ratio__[b.material_i][b.material_j];
    const double stiffness = law->prepare(&b, kind.constant);
    kind.mass = b.mass;
    kind.sum = b.radius_i + b.radius_j;
    kind.part = b.radius_i / kind.sum;
    const double k = stiffness * w->dt__ * w->dt__ / b.mass;
    kind.predict = dem__prediction(k, 2.0 * b.damping_ratio * sqrt(k));
    while (same < w->kinds__ && memcmp(&w->kind__[same], &kind, sizeof kind) != 0) same++;
    if (same < DEM_KINDS_MAX) {
        w->live_kind__[c] = same;
        w->kind__[same] = kind;
        w->kinds__ += same == w->kinds__;
        return;
    }
    w->kinds__ = DEM_KINDS_MAX + 1; /* from now on each has its own: to look for a kind would cost more than it saves */
    w->live_kind__[c] = -1;
    for (int a = 0; a < law->constants; a++) w->live_constant__[a][c] = kind.constant[a];
    w->live_mass__[c] = kind.mass;
    w->live_predict__[c] = kind.predict;
    w->live_sum__[c] = kind.sum;
    w->live_part__[c] = kind.part;
}

DEM_INLINE int dem__ascends(const int32_t *list, ptrdiff_t n) {
    for (ptrdiff_t k = 1; k < n; k++) {
        if (list[k] < list[k - 1]) return 0;
    }
    return 1;
}

/* The contacts born since the last call, which slots__ lists by partners, from the end of the last section into sections of their own:
   lists their slots instead. */
static inline void dem__assign(dem_world *w, const dem__array *list, int arrays) {
    dem__section born[DEM__SECTIONS];
    const int last = w->sections__ - 1;
    ptrdiff_t n = 0;
    w->section__[last].live -= w->born__;
    for (int q = 0; q <= last; q++) {
        dem__section *in = &w->section__[q];
        born[q].first = in->first + in->live;
        born[q].live = 0;
    }
    for (ptrdiff_t k = 0, q = 0; k < w->born__; k++) {
        while (w->live_i__[w->slots__[k]] < w->section__[q].from) q++;
        if (q < last && w->section__[q].live + born[q].live == w->section__[q].room) q = last; /* and so all after it */
        born[q].live++;
    }
    if (last > 0 || !dem__ascends(w->slots__, w->born__)) dem__arrange(w, w->born__, born, w->sections__, list, arrays);
    for (int q = 0; q <= last; q++) {
        w->section__[q].live += born[q].live;
        for (ptrdiff_t c = born[q].first; c < born[q].first + born[q].live; c++) {
            w->slots__[n++] = (int32_t)c;
        }
    }
}

/* Makes the contacts born since the last call ready, and puts them into the order. */
static inline void dem__admit_born(dem_world *w, double gap) {
    const ptrdiff_t born = w->born__, old = dem__next_slot(w) - born;
    dem__array list[8] = {{&w->live_i__, sizeof(int32_t)},
                          {&w->live_j__, sizeof(int32_t)},
                          {&w->live_element__, sizeof(int32_t)},
                          {&w->live_near__, sizeof(int32_t)}};
    int arrays = 4;
    for (int a = 0; w->places__ && a < 4; a++, arrays++) list[arrays].address = &w->live_place__[a], list[arrays].size = sizeof(double);
    if (!born) return;
    for (ptrdiff_t k = 0; k < born; k++) w->slots__[k] = (int32_t)(old + k);
    dem__sort(w, w->slots__, born);
    dem__assign(w, list, arrays);
    for (ptrdiff_t k = 0; k < born; k++) {
        const ptrdiff_t c = w->slots__[k], i = w->live_i__[c], j = w->live_j__[c];
        dem__activate(w, i);
        if (j >= 0) dem__activate(w, j);
        else {
            w->live_wall_next__[c] = w->wall_head__[i];
            w->wall_head__[i] = (int32_t)c;
        }
        for (int a = 0; a < w->states__; a++) w->live_state__[a][c] = 0.0;
        w->live_gap__[c] = gap;
        w->live_force__[c] = 0.0;
        w->live_event__[c] = w->live_ended__[c] = 0;
        if (w->ledger_on__) {
            w->live_elastic__[c] = 0.0;
            for (int a = 0; a < 3; a++) w->live_power__[a][c] = 0.0;
        }
    }
    w->born__ = 0;
}

/* Tells the law of the contacts in the slots that slots__ lists. */
static inline void dem__tell_born(dem_world *w, const dem_law *law, ptrdiff_t born) {
    if (!law->born || born == 0) return;
    for (ptrdiff_t k = 0; k < born; k++) w->slots__[k] = dem__number_of(w, w->slots__[k]);
    law->born(w, w->slots__, born, w->user);
}

static inline void dem__unlink_wall_contact(dem_world *w, ptrdiff_t i, int32_t slot, int32_t replacement) {
    int32_t *link = &w->wall_head__[i];
    while (*link >= 0 && *link != slot) link = &w->live_wall_next__[*link];
    if (*link == slot) *link = replacement >= 0 ? replacement : w->live_wall_next__[slot];
}

/* Ahead of a look at a particle's course. */
DEM_INLINE void dem__fetch_flight(const dem_world *w, ptrdiff_t i) {
    dem__fetch_particle(w, i);
    DEM__PREFETCH(&w->course__[i]);
}

/* Ahead of a contact's end. */
DEM_INLINE void dem__fetch_end(const dem_world *w, ptrdiff_t c) {
    const int32_t p = w->live_near__[c];
    dem__fetch_flight(w, w->live_i__[c]);
    if (p < 0) return;
    dem__fetch_flight(w, w->live_j__[c]);
    DEM__PREFETCH(&w->near__[p]);
    DEM__PREFETCH(&w->pair_timers__.due[p]);
}

/* One contact ends. */
static inline void dem__end(dem_world *w, dem__waits *waits, int32_t c, int64_t step) {
    const ptrdiff_t i = w->live_i__[c], j = w->live_j__[c];
    const int32_t near_pair = w->live_near__[c];
    if (w->law__ && w->law__->ended) w->law__->ended(w, dem__number_of(w, c), w->user);
    w->touching[i]--;
    dem__divide(w, i);
    dem__unsettle(w, i);
    if (w->ledger_on__) w->ledger__.sliding_loss += w->live_elastic__[c];
    if (j >= 0) {
        w->touching[j]--;
        dem__divide(w, j);
        dem__unsettle(w, j);
        if (near_pair < 0 || w->stale__) return;
        if (!(w->alive[i] > 0 && w->alive[j] > 0)) return;
        w->pair_timers__.due[near_pair] = DEM__NEVER;
        if (w->def.skip & DEM_SKIP_PAIRS) dem__wait_from(w, waits, near_pair, step, dem__pair_apart(w, i, j, step));
        return;
    }
    dem__unlink_wall_contact(w, i, c, -1);
    /* a screen's timer went on for its other bars, but did not wait for this one */
    if (!w->stale__ && w->alive[i] > 0 && (w->def.skip & DEM_SKIP_SPACE) && dem__awaits(w, i, -1 - (int)j))
        dem__set_timer(&w->wall_timers__, (int32_t)i * w->walls - 1 - (int32_t)j, step + 1);
}

/* The contact of slot `from` goes into a free one. */
static inline void dem__move_contact(dem_world *w, int32_t from, int32_t to, const dem__array *list, int n) {
    if (w->live_j__[from] < 0) {
        w->live_wall_next__[to] = w->live_wall_next__[from];
        dem__unlink_wall_contact(w, w->live_i__[from], from, to);
    }
    for (int a = 0; a < n; a++) {
        char *base;
        memcpy(&base, list[a].address, sizeof base);
        dem__copy(base + (size_t)to * list[a].size, base + (size_t)from * list[a].size, list[a].size);
    }
}

/* Takes out contacts that ended, of those that the last step marked or of all: slots at the end of their section fill the gaps. */
static inline void dem__bury(dem_world *w, int64_t step, int all) {
    dem__array list[DEM__ARRAYS_MAX];
    const ptrdiff_t dead = dem__list_ended(w, all);
    if (dead == 0) return;
    const int n = dem__held_arrays(w, list);
    ptrdiff_t next = 0;
    dem__waits waits;
    dem__no_waits(&waits);
    for (ptrdiff_t k = -DEM__AHEAD; k < dead; k++) {
        if (k + DEM__AHEAD < dead) dem__fetch_end(w, w->slots__[k + DEM__AHEAD]);
        if (k >= 0) dem__end(w, &waits, w->slots__[k], step);
    }
    dem__set_waits(w, &waits, step);
    w->live_count__ -= dead;
    for (int q = 0; q < w->sections__; q++) {
        dem__section *in = &w->section__[q];
        const ptrdiff_t first = next;
        ptrdiff_t last = in->first + in->live;
        while (next < dead && w->slots__[next] < last) next++;
        in->live -= next - first;
        for (ptrdiff_t k = first; k < next && w->slots__[k] < in->first + in->live; k++) {
            while (w->live_ended__[last - 1]) last--;
            dem__move_contact(w, (int32_t)--last, w->slots__[k], list, n);
        }
    }
}
