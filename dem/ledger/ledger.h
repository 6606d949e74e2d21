/* The energy ledger as a feature of a world: when it begins, pauses and resumes, its balance, and what a save keeps. */
#pragma once
#include "../contacts/forces.h"
#include "../records/groups.h"
#include "losses.h"
#include "../particles/active.h"

/* Returns the remainder of the energy balance [J]. */
static inline double dem__ledger_error(const dem_energy_ledger *l) {
    return l->kinetic + l->rotational + l->elastic + l->potential + l->normal_loss + l->sliding_loss + l->rolling_loss +
           l->removed - l->start - l->added - l->wall_work - l->external_work - l->field_work - l->link_work;
}

DEM_API dem_energy_ledger dem_energy(const dem_world *world) {
    dem_energy_ledger l;
    memset(&l, 0, sizeof l);
    if (!world || !world->engine) return l;
    const dem__ledger *ledger = &world->engine->ledger;
    l = ledger->sums;
    l.kinetic = l.rotational = l.potential = 0.0;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        if (!world->alive[i]) continue;
        l.kinetic += dem__kinetic(world, i);
        l.rotational += dem__rotational(world, i);
        l.potential += dem__potential(world, i);
        if (ledger->on) DEM__TELL(world, open_books, (world, i, &l));
    }
    l.elastic = dem__stored_energy(world);
    if (!ledger->started) return l;
    l.released = l.start_potential + l.added_potential - l.removed_potential - l.potential;
    l.released = l.released > 0.0 ? l.released : 0.0;
    l.error = ledger->counts ? dem__ledger_error(&l) : ledger->paused_error;
    return l;
}

/* ---- the feature ---- */

static inline int dem__list_contact_arrays_of_ledger(dem_world *w, dem__array *list) {
    dem__contacts *contacts = &w->engine->contacts;
    int n = 0;
    list[n].address = &contacts->elastic, list[n++].size = sizeof(double);
    for (int k = 0; k < 3; k++, n++) list[n].address = &contacts->power[k], list[n].size = sizeof(double);
    for (int k = 0; k < 4; k++, n++) list[n].address = &contacts->loss[k], list[n].size = sizeof(double);
    return n;
}

/* Begins, pauses or resumes the ledger. Changes during a pause enter no sum. The start is shifted by them, so that they
   count as no error either. */
static inline void dem__switch_ledger(dem_world *w, const dem_kernel *kernel) {
    dem__ledger *ledger = &w->engine->ledger;
    const int counts = (w->engine->run.features & DEM_ENERGY) != 0;
    if (ledger->counts == counts) return;
    if (!counts) ledger->paused_error = dem_energy(w).error;
    else dem__find_stored(w, kernel->loop);
    ledger->counts = counts;
    if (counts && ledger->started) ledger->sums.start += dem_energy(w).error - ledger->paused_error;
}

/* Starts the ledger in the first run that keeps one. */
static inline void dem__open_ledger(dem_world *w) {
    dem__ledger *ledger = &w->engine->ledger;
    if (!ledger->counts || ledger->started) return;
    ledger->started = 1;
    memset(&ledger->sums, 0, sizeof ledger->sums); /* a run that failed may have booked something */
    DEM__TELL(w, begin_ledger, (w));
    const dem_energy_ledger now = dem_energy(w);
    ledger->sums.start = now.kinetic + now.rotational + now.elastic + now.potential;
    ledger->sums.start_potential = now.potential;
}

/* Book the energy that contacts gain or lose by changes of the caller between runs: new contacts, other constants. */
static inline void dem__note_stored(dem_world *w) { w->engine->ledger.stored_before = dem__stored_energy(w); }
static inline void dem__book_stored(dem_world *w) {
    dem__ledger *ledger = &w->engine->ledger;
    if (ledger->started) ledger->sums.added += dem__stored_energy(w) - ledger->stored_before;
}

/* Contacts that begin have stored nothing. Sums are taken in the order of memory, whenever lists were built. */
static inline void dem__begin_contact_ledger(dem_world *w, ptrdiff_t begun) {
    dem__contacts *contacts = &w->engine->contacts;
    for (ptrdiff_t k = 0; k < begun; k++) {
        const int32_t c = contacts->slots[k];
        contacts->elastic[c] = 0.0;
        for (int a = 0; a < 3; a++) contacts->power[a][c] = 0.0;
    }
    if (begun > 0) dem__list_active(w);
}

static inline void dem__book_step(dem_world *w, double h) {
    if (w->engine->ledger.counts && h > 0.0) dem__book_losses(w);
}

static inline void dem__world_fields_of_ledger(dem_world *w, dem__group *g) {
    dem__engine *e = w->engine;
    dem_energy_ledger *l = &e->ledger.sums;
    const dem__saved_field fields[] = {
        DEM__INTEGER("ledger.on", e->ledger.on, 0),
        DEM__INTEGER("ledger.started", e->ledger.started, 0),
        DEM__INTEGER("ledger.counts", e->ledger.counts, 0),
        DEM__DOUBLES("ledger.paused_error", e->ledger.paused_error, 0),
        DEM__DOUBLES("ledger.normal_loss", l->normal_loss, 0),
        DEM__DOUBLES("ledger.sliding_loss", l->sliding_loss, 0),
        DEM__DOUBLES("ledger.rolling_loss", l->rolling_loss, 0),
        DEM__DOUBLES("ledger.wall_work", l->wall_work, 0),
        DEM__DOUBLES("ledger.link_work", l->link_work, 0),
        DEM__DOUBLES("ledger.field_work", l->field_work, 0),
        DEM__DOUBLES("ledger.external_work", l->external_work, 0),
        DEM__DOUBLES("ledger.added", l->added, 0),
        DEM__DOUBLES("ledger.removed", l->removed, 0),
        DEM__DOUBLES("ledger.start", l->start, 0),
        DEM__DOUBLES("ledger.start_pot", l->start_potential, 0),
        DEM__DOUBLES("ledger.added_pot", l->added_potential, 0),
        DEM__DOUBLES("ledger.removed_pot", l->removed_potential, 0),
    };
    dem__add_optional(g, fields, sizeof fields);
}

static inline void dem__contact_fields_of_ledger(dem_world *w, dem__group *g) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__add_fields(g, "contact.elastic", &contacts->elastic, 1);
    dem__add_fields(g, "contact.power", contacts->power, 3);
}

static inline int dem__has_ledger(const dem__file *file, const dem_world *w) {
    const dem__ledger *ledger = &w->engine->ledger;
    (void)file;
    if (!dem__is_flag(ledger->on) || !dem__is_flag(ledger->started) || !dem__is_flag(ledger->counts)) return -1;
    if (!ledger->on && (ledger->started || ledger->counts)) return -1; /* without arrays nothing is counted */
    return ledger->on;
}

static inline dem__feature dem__feature_ledger(void) {
    dem__feature f = dem__new_feature(DEM__LEDGER_FEATURE);
    f.list_contact_arrays = dem__list_contact_arrays_of_ledger;
    f.set_law = dem__switch_ledger;
    f.find_forces = dem__note_stored;
    f.forces_found = dem__book_stored;
    f.begin_run = dem__open_ledger;
    f.contacts_begun = dem__begin_contact_ledger;
    f.add_forces = dem__book_step;
    f.end_contact = dem__book_contact_end;
    f.world_fields = dem__world_fields_of_ledger;
    f.contact_fields = dem__contact_fields_of_ledger;
    f.is_used = dem__has_ledger;
    return f;
}
static inline void dem__add_ledger(dem_world *w) { dem__add_feature(w, dem__feature_ledger()); }
