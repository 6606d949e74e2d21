/* ------------------------------------------------------------------------------------------------ >>memory */

static inline void *dem__default_allocator(void *user, void *old, size_t old_size, size_t new_size) {
    (void)user;
    (void)old_size;
    if (new_size > 0) return realloc(old, new_size);
    free(old);
    return NULL;
}

/* The arrays of a group: their addresses, so that growing, freeing and saving are loops. */
typedef struct dem__array {
    void *address; /* of the pointer */
    size_t size;   /* of an entry */
} dem__array;
enum { DEM__ARRAYS_MAX = 96, DEM__STEP_ARRAYS = 3, DEM__OUT_ARRAYS = 9, DEM__OWN_ARRAYS = 4 };

static inline int dem__particle_arrays(dem_world *w, dem__array *list) {
    int n = 0;
    double **doubles[] = {&w->wall_speed__, &w->shifted__, &w->share__};
    dem__six **sixes[] = {&w->load__, &w->external__, &w->linked__};
    int32_t **integers[] = {&w->material,         &w->group,       &w->alive,   &w->touching,    &w->active__,    &w->wall_head__,
                            &w->adjacent_start__, &w->cell_next__, &w->remap__, &w->is_active__, &w->link_head__, &w->link_loaded__,
                            &w->unsettled__};
    for (size_t k = 0; k < sizeof doubles / sizeof *doubles; k++, n++) {
        list[n].address = doubles[k], list[n].size = sizeof(double);
    }
    for (size_t k = 0; k < sizeof sixes / sizeof *sixes; k++, n++) {
        list[n].address = sixes[k], list[n].size = sizeof(dem__six);
    }
    for (size_t k = 0; k < sizeof integers / sizeof *integers; k++, n++) {
        list[n].address = integers[k], list[n].size = sizeof(int32_t);
    }
    list[n].address = &w->particle, list[n++].size = sizeof(dem_particle);
    list[n].address = &w->spin_rate, list[n++].size = sizeof(dem_vec);
    list[n].address = &w->listed_at__, list[n++].size = sizeof(dem_vec);
    list[n].address = &w->impact__, list[n++].size = sizeof(dem_vec);
    list[n].address = &w->id, list[n++].size = sizeof(uint64_t);
    list[n].address = &w->course__, list[n++].size = sizeof(dem__course);
    list[n].address = &w->sum__, list[n++].size = sizeof(dem__sum);
    return n;
}

static inline int dem__has_deferrals(const dem_world *w) { return w->deferral__ || w->def.threads > 1; }

/* Of contacts, in the order of how long they hold something: from step to step, ... */
static inline int dem__live_arrays(dem_world *w, dem__array *list) {
    int n = 0;
    int32_t **integers[] = {&w->live_i__, &w->live_j__, &w->live_element__, &w->live_near__, &w->live_wall_next__, &w->live_kind__};
    double **own[DEM__OWN_ARRAYS] = {&w->live_predict__, &w->live_mass__, &w->live_sum__, &w->live_part__};
    for (size_t k = 0; k < sizeof integers / sizeof *integers; k++, n++) list[n].address = integers[k], list[n].size = sizeof(int32_t);
    list[n].address = &w->live_gap__, list[n++].size = sizeof(double);
    list[n].address = &w->live_force__, list[n++].size = sizeof(double);
    for (int k = 0; k < w->states__; k++, n++) list[n].address = &w->live_state__[k], list[n].size = sizeof(double);
    for (int k = 0; w->places__ && k < 4; k++, n++) list[n].address = &w->live_place__[k], list[n].size = sizeof(double);
    if (w->ledger_on__) {
        list[n].address = &w->live_elastic__, list[n++].size = sizeof(double);
        for (int k = 0; k < 3; k++, n++) list[n].address = &w->live_power__[k], list[n].size = sizeof(double);
        for (int k = 0; k < 4; k++, n++) list[n].address = &w->live_loss__[k], list[n].size = sizeof(double);
    }
    list[n].address = &w->live_ended__, list[n++].size = 1;
    /* ... with constants of their own, ... */
    for (int k = 0; k < DEM__OWN_ARRAYS; k++, n++) list[n].address = own[k], list[n].size = sizeof(double);
    for (int k = 0; k < w->constants__; k++, n++) list[n].address = &w->live_constant__[k], list[n].size = sizeof(double);
    /* ... after the last step of a run, ... */
    for (int k = 0; k < DEM__OUT_ARRAYS; k++, n++) list[n].address = &w->live_out__[k], list[n].size = sizeof(double);
    /* ... within a step */
    list[n].address = &w->live_handed__, list[n++].size = sizeof(dem__handed);
    list[n].address = &w->live_event__, list[n++].size = 1;
    list[n].address = &w->slots__, list[n++].size = sizeof(int32_t);
    if (dem__has_deferrals(w)) list[n].address = &w->deferral__, list[n++].size = sizeof(dem__deferral);
    return n;
}

/* Of those the first so many hold something when a contact is moved to another slot. */
static inline int dem__held_arrays(dem_world *w, dem__array *list) {
    const int with_out = dem__live_arrays(w, list) - dem__has_deferrals(w) - DEM__STEP_ARRAYS, with_own = with_out - DEM__OUT_ARRAYS;
    return w->keeps_out__ ? with_out : w->kinds__ > DEM_KINDS_MAX ? with_own : with_own - DEM__OWN_ARRAYS - w->constants__;
}

/* All arrays of a group lie in one block, so that growing works for all or changes nothing. Each begins with a cache line. */
static inline int dem__grow_group(dem_world *w, const dem__array *list, int n, void **block, size_t *bytes, ptrdiff_t *capacity,
                                  ptrdiff_t wanted) {
    ptrdiff_t larger = *capacity + *capacity / 2 + 64;
    size_t total = 64;
    if (larger < wanted) larger = wanted;
    for (int k = 0; k < n; k++) {
        if ((size_t)larger > (SIZE_MAX / 4 - total) / list[k].size) return 0;
        total += ((size_t)larger * list[k].size + 63) & ~(size_t)63;
    }
    char *fresh = (char *)w->def.allocator.fn(w->def.allocator.user, NULL, 0, total), *at = fresh;
    if (!fresh) return 0;
    memset(fresh, 0, total);
    at += 64 - (size_t)((uintptr_t)fresh & 63);
    for (int k = 0; k < n; k++) {
        void *old = NULL, *now = at;
        memcpy(&old, list[k].address, sizeof old);
        if (old && *capacity > 0) memcpy(now, old, (size_t)*capacity * list[k].size);
        memcpy(list[k].address, &now, sizeof now);
        at += ((size_t)larger * list[k].size + 63) & ~(size_t)63;
    }
    if (*block) w->def.allocator.fn(w->def.allocator.user, *block, *bytes, 0);
    *block = fresh;
    *bytes = total;
    *capacity = larger;
    return 1;
}

static inline int dem__link_arrays(dem_world *w, dem__array *list) {
    int n = 0;
    int32_t **integers[] = {&w->link_i__, &w->link_j__, &w->link_element__, &w->link_next_i__, &w->link_next_j__};
    for (size_t k = 0; k < sizeof integers / sizeof *integers; k++, n++) list[n].address = integers[k], list[n].size = sizeof(int32_t);
    for (int k = 0; k < w->link_states__; k++, n++) list[n].address = &w->link_state__[k], list[n].size = sizeof(double);
    for (int k = 0; k < 9; k++, n++) list[n].address = &w->link_out__[k], list[n].size = sizeof(double);
    list[n].address = &w->link_gap__, list[n++].size = sizeof(double);
    list[n].address = &w->link_ended__, list[n++].size = 1;
    return n;
}

/* Room for so many timers, and for what else is kept of each, so many bytes. */
static inline int dem__grow_timers(dem_world *w, dem__timers *t, ptrdiff_t count, void *other, size_t bytes) {
    const dem__array list[] = {{&t->due, DEM__BUNCH * sizeof *t->due},
                               {&t->list, DEM__BUNCH * sizeof *t->list},
                               {&t->earliest, sizeof *t->earliest},
                               {other, DEM__BUNCH * bytes}};
    const ptrdiff_t bunches = (count / DEM__SHEAF + 1) * DEM__BUNCH;
    return bunches <= t->capacity || dem__grow_group(w, list, 4, &t->block, &t->bytes, &t->capacity, bunches);
}
static inline int dem__grow_near(dem_world *w, ptrdiff_t count) {
    return dem__grow_timers(w, &w->pair_timers__, count, &w->near__, sizeof *w->near__);
}

/* So many timers, of which those from `kept` on are stopped. */
static inline void dem__stop_timers(dem__timers *t, ptrdiff_t kept, ptrdiff_t count) {
    t->sheaves = count / DEM__SHEAF + 1;
    for (ptrdiff_t e = kept; e < t->sheaves * DEM__SHEAF; e++) t->due[e] = DEM__STOPPED;
    for (ptrdiff_t b = 0; b < t->sheaves * DEM__BUNCH; b++) {
        t->earliest[b] = DEM__STOPPED;
        for (const int32_t *due = t->due + b * DEM__BUNCH, *end = due + DEM__BUNCH; due < end; due++)
            t->earliest[b] = *due < t->earliest[b] ? *due : t->earliest[b];
    }
}

/* Steps counted from another one. */
static inline void dem__count_from(dem__timers *t, int64_t step) {
    const int32_t later = (int32_t)(step - t->from);
    for (ptrdiff_t e = 0; e < t->sheaves * DEM__SHEAF; e++) t->due[e] -= t->due[e] < DEM__NEVER ? later : 0;
    for (ptrdiff_t b = 0; b < t->sheaves * DEM__BUNCH; b++) t->earliest[b] -= t->earliest[b] < DEM__NEVER ? later : 0;
    t->from = step;
}

/* One plain array as a group of its own. */
static inline int dem__grow_one(dem_world *w, int32_t **array, ptrdiff_t *capacity, ptrdiff_t wanted) {
    if (wanted <= *capacity) return 1;
    ptrdiff_t larger = wanted + wanted / 4 + 64;
    int32_t *fresh = (int32_t *)w->def.allocator.fn(w->def.allocator.user, NULL, 0, (size_t)larger * sizeof *fresh);
    if (!fresh) return 0;
    if (*array) w->def.allocator.fn(w->def.allocator.user, *array, (size_t)*capacity * sizeof **array, 0);
    *array = fresh;
    *capacity = larger;
    return 1;
}
