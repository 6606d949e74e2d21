/* Active particles in the order of memory. */
static inline void dem__list_active(dem_world *w) {
    w->active_count__ = w->unsettled_count__ = 0;
    for (int32_t i = 0; i < (int32_t)w->count; i++) {
        w->active__[w->active_count__] = i;
        w->active_count__ += w->is_active__[i] != 0;
        if (w->is_active__[i] == 2) w->unsettled__[w->unsettled_count__++] = i;
    }
}

/* Wall timers of the `left` particles that remap__ keeps, under their new numbers. */
static inline void dem__move_wall_timers(dem_world *w, ptrdiff_t left) {
    dem__timers *t = &w->wall_timers__;
    if (w->stale__) return; /* they are made anew */
    for (ptrdiff_t i = 0; i < w->count; i++) {
        for (int k = 0; k < w->walls && w->remap__[i] >= 0; k++) {
            t->due[w->remap__[i] * w->walls + k] = t->due[i * w->walls + k];
            w->wall_sure__[w->remap__[i] * w->walls + k] = w->wall_sure__[i * w->walls + k];
        }
    }
    dem__stop_timers(t, left * w->walls, left * w->walls);
}

DEM_INLINE void dem__close_gaps(char *base, size_t size, const int32_t *remap, ptrdiff_t first, ptrdiff_t count) {
    for (ptrdiff_t i = first; i < count; i++) {
        if (remap[i] >= 0) memcpy(base + (size_t)remap[i] * size, base + (size_t)i * size, size);
    }
}

/* The number of particle i, or of the first after it that stays, when those are numbered by remap__. */
static inline int32_t dem__remapped(const dem_world *w, int32_t i) {
    while (i < (int32_t)w->count && w->remap__[i] < 0) i++;
    return i < (int32_t)w->count ? w->remap__[i] : (int32_t)(w->count - w->dropped__);
}

/* Takes dropped particles out of the arrays, keeping the order of the others. */
static inline void dem__compact(dem_world *w) {
    if (!w->dropped__) return;
    ptrdiff_t to = 0;
    dem__array list[DEM__ARRAYS_MAX];
    int n = dem__particle_arrays(w, list);
    for (ptrdiff_t i = 0; i < w->count; i++) w->remap__[i] = w->alive[i] ? (int32_t)to++ : -1;
    int32_t *remap = w->remap__;
    ptrdiff_t first = 0;
    while (first < w->count && remap[first] == first) first++;
    for (int k = 0; k < n; k++) {
        char *base;
        memcpy(&base, list[k].address, sizeof base);
        if ((void *)base == (void *)remap) continue;
        if (list[k].size == sizeof(double)) dem__close_gaps(base, sizeof(double), remap, first, w->count);
        else if (list[k].size == sizeof(int32_t)) dem__close_gaps(base, sizeof(int32_t), remap, first, w->count);
        else dem__close_gaps(base, list[k].size, remap, first, w->count);
    }
    dem__move_wall_timers(w, to);
    DEM__EACH(w, c) {
        w->live_i__[c] = remap[w->live_i__[c]];
        if (w->live_j__[c] >= 0) w->live_j__[c] = remap[w->live_j__[c]];
    }
    for (int q = 0; q < w->sections__; q++) w->section__[q].from = dem__remapped(w, w->section__[q].from);
    for (ptrdiff_t k = 0; k < w->link_count__; k++) {
        w->link_i__[k] = remap[w->link_i__[k]];
        if (w->link_j__[k] >= 0) w->link_j__[k] = remap[w->link_j__[k]];
    }
    w->count = to;
    w->dropped__ = 0;
}
