/* dem_wet.h - composes dem.h and liquid_bridge.h: the dry linear law with friction and rolling, and liquid bridges.
   A bridge forms when two bodies touch and is a link until its gap is beyond dynamic rupture: capillary force and viscous resistance
   change little in 0.2 ms, so that links are evaluated once in many steps. What changes faster, the resistance below `near`, which grows
   as 1/S, belongs to the contact. Films and books are the scene's. */
#ifndef WET_CONTACT_H
#define WET_CONTACT_H

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "dem.h"
#include "liquid_bridge.h"

/* State of a contact behind its friction history: the bridge's width and radius (0: dry). */
enum { WET_WIDTH = 3, WET_RADIUS, WET_STATES };
/* State of a link: the bridge; for the printed equations also the contact angles, and 1 if j is a wall. */
enum { WET_BRIDGE_SIZE = sizeof(bridge) / sizeof(double), WET_ANGLE_I = WET_BRIDGE_SIZE, WET_ANGLE_J, WET_IS_WALL, WET_LINK_STATES };
enum { WET_CLASSES = 3, WET_DECK = WET_CLASSES, WET_SIDE, WET_PARTNERS }; /* walls by their contact angle: decks, others */
static const double WET_INTERVAL = 2e-4, WET_NEAR = 2e-6;                 /* between evaluations of links [s]; gap [m] */

typedef struct wet_scene {
    bridge_liquid liquid;
    double angle[3];                             /* contact angle of particles, of decks, of other walls [rad] */
    bool printed;                                /* eqs 12-18 as printed */
    bridge_pair kind[WET_CLASSES][WET_PARTNERS]; /* classes a <= b, or a wall */
    bridge_films films;
    const int *group; /* class of particle by id */
    int deck, decks;  /* wall index of the first screen, or of what stands in its place; how many there are */
    double patch, wall_radius;
    int around, up, bars; /* patches of the side wall; bars of a family, patches of a bar; without wires patches are one family */
    long long ruptures;
    double initial; /* liquid at the start [m3] */
    bridge_status status;
} wet_scene;

/* ---- laws: what the kernels inline; without branches, so that their loops vectorise ---- */

/* Normal, translation and spin resistance at a gap [N s/m], or none: share 1 or 0. */
DEM_INLINE void wet_resistance(const bridge *b, const bridge_liquid *liquid, double gap, bool printed, double share, double *resistance) {
    const bridge_resistances r = bridge_resistance(b, liquid, gap);
    const double rs = 0.5 * b->radius, sv = bridge_viscous_gap(gap, rs, liquid->roughness);
    resistance[0] = share * r.normal;
    resistance[1] = share * (printed ? bridge_printed_drag_translation(sv, rs, liquid->viscosity) : r.tangential);
    resistance[2] = share * (printed ? bridge_printed_drag_spin(sv, rs, liquid->viscosity) : r.tangential);
}

DEM_INLINE void wet_resist(const dem_contact *c, const double *resistance, dem_response *r) {
    r->normal += resistance[0] * c->closing;
    r->rolling_power += resistance[0] * c->closing * c->closing;
    for (int a = 0; a < 3; a++) {
        const double drag = resistance[1] * c->translation[a] + resistance[2] * (c->slip[a] - c->translation[a]);
        r->remaining[a] = -drag;
        r->tangential[a] -= drag;
        r->rolling_power += drag * c->slip[a];
    }
}

DEM_INLINE void wet_contact_force(const dem_contact *c, double *state, dem_response *r, bool printed) {
    const bridge_liquid liquid = ((const wet_scene *)c->user)->liquid;
    const double radius = state[WET_RADIUS] > 0.0 ? state[WET_RADIUS] : 1.0, wet = state[WET_RADIUS] > 0.0 ? 1.0 : 0.0;
    const double near = c->gap < WET_NEAR ? 1.0 : 0.0;
    const bridge b = {0.0, state[WET_WIDTH], 0.0, radius, 0.0, {0.0}};
    double resistance[3];
    dem_force_linear_rolling(c, state, r);
    wet_resistance(&b, &liquid, c->gap, printed, wet * near, resistance);
    wet_resist(c, resistance, r);
    /* what is linked is in contact as long as it is near; what is dry ends with the overlap, as the dry law said */
    r->ended = wet > 0.0 ? 1.0 - near : r->ended;
}
DEM_INLINE void wet_force(const dem_contact *c, double *state, dem_response *r) { wet_contact_force(c, state, r, false); }
DEM_INLINE void wet_force_printed(const dem_contact *c, double *state, dem_response *r) { wet_contact_force(c, state, r, true); }

DEM_INLINE void wet_bridge_force(const dem_contact *c, double *state, dem_response *r, bool printed) {
    const double *s = state;
    const bridge_liquid liquid = ((const wet_scene *)c->user)->liquid;
    const bridge b = {s[0], s[1], s[2], s[3], s[4], {s[5], s[6], s[7], s[8], s[9], s[10], s[11]}};
    const double gap = c->gap > 0.0 ? c->gap : 0.0;
    double resistance[3], pull;
    if (printed)
        pull = s[WET_IS_WALL] > 0.0
                   ? bridge_printed_force_wall(gap, b.volume, 0.5 * b.radius, s[WET_ANGLE_I], s[WET_ANGLE_J], liquid.surface_tension)
                   : bridge_printed_force(gap, b.volume, b.radius, s[WET_ANGLE_I], s[WET_ANGLE_J], liquid.surface_tension);
    else pull = bridge_attraction(&b, c->gap);
    wet_resistance(&b, &liquid, gap, printed, c->gap < WET_NEAR ? 0.0 : 1.0, resistance);
    r->normal = -pull;
    r->tangential[0] = r->tangential[1] = r->tangential[2] = r->rolling_power = 0.0;
    wet_resist(c, resistance, r);
    r->ended = bridge_is_ruptured(&b, &liquid, c->gap, -c->closing) ? 1.0 : 0.0;
}
DEM_INLINE void wet_link_force(const dem_contact *c, double *state, dem_response *r) { wet_bridge_force(c, state, r, false); }
DEM_INLINE void wet_link_force_printed(const dem_contact *c, double *state, dem_response *r) { wet_bridge_force(c, state, r, true); }

/* ---- books ---- */

static bool wet_is_deck(const wet_scene *s, ptrdiff_t j) { return -1 - j >= s->deck && -1 - j < s->deck + s->decks; }
static bool wet_has_wires(const dem_world *w, int wall) { return w->wall[wall].kind == DEM_SCREEN; }
static double wet_pitch(const wet_scene *s, const dem_world *w, int wall) {
    return wet_has_wires(w, wall) ? w->wall[wall].aperture + w->wall[wall].wire : s->patch;
}

/* Which film patch of the walls a contact draws from: 5 mm squares of the side wall and of a deck without wires, one pitch of a bar. */
static size_t wet_patch(const wet_scene *s, const dem_world *w, const dem_contact_info *c) {
    const int wall = (int)(-1 - c->j);
    const dem_vec at = dem_position(w, c->i), origin = w->wall[wall].position;
    const double x = at.x - origin.x, y = at.y - origin.y, z = at.z - origin.z;
    if (!wet_is_deck(s, c->j)) {
        const int a = (int)((riddle_atan2(y, x) / RIDDLE_PI + 1.0) * 0.5 * s->around), u = (int)(z / s->patch) + 2;
        return (size_t)((a < 0 ? 0 : a >= s->around ? s->around - 1 : a) + s->around * (u < 0 ? 0 : u >= s->up ? s->up - 1 : u));
    }
    const double pitch = wet_pitch(s, w, wall);
    const bool wires = wet_has_wires(w, wall);
    const int side = s->around * s->up + (wall - s->deck) * 2 * s->bars * s->bars;
    const int family = wires ? (int)((unsigned)c->element & 1u) : 0;
    const int bar = wires ? (c->element - family) / 2 + s->bars / 2 : (int)(y / pitch + s->bars / 2.0);
    const int segment = (int)((family ? y : x) / pitch + s->bars / 2.0);
    const int b = bar < 0 ? 0 : bar >= s->bars ? s->bars - 1 : bar, k = segment < 0 ? 0 : segment >= s->bars ? s->bars - 1 : segment;
    return (size_t)(side + (family * s->bars + b) * s->bars + k);
}

static bridge_partner wet_partner(const dem_world *w, const dem_contact_info *c) {
    return c->j >= 0 ? BRIDGE_SPHERE : wet_has_wires(w, (int)(-1 - c->j)) ? BRIDGE_WIRE : BRIDGE_WALL;
}

/* The prepared kind of a contact's pair; swapped: the contact's i is the kind's j. */
static const bridge_pair *wet_kind(const wet_scene *s, const dem_world *w, const dem_contact_info *c, int *swapped) {
    const int a = s->group[w->id[c->i]], b = c->j >= 0 ? s->group[w->id[c->j]] : wet_is_deck(s, c->j) ? WET_DECK : WET_SIDE;
    *swapped = a > b;
    return &s->kind[a < b ? a : b][a < b ? b : a];
}

/* Tells the contact of that number what it needs to know of its bridge. */
static void wet_tell_contact(dem_world *w, int32_t number, const bridge *b) {
    dem_contact_info c = dem_get_contact(w, number);
    c.state[WET_WIDTH] = b->width;
    c.state[WET_RADIUS] = b->radius;
    dem_set_contact_state(w, number, c.state);
}

static bridge_status wet_link(wet_scene *s, dem_world *w, int32_t number, const bridge_contact *q) {
    const dem_contact_info c = dem_get_contact(w, number);
    double state[WET_LINK_STATES];
    bridge b;
    int swapped;
    const bridge_pair *kind = wet_kind(s, w, &c, &swapped);
    const double other = c.j >= 0 ? q->radius_j : (double)INFINITY;
    const bridge_status status = s->printed ? bridge_form_printed(kind, q->radius_i, other, q->given_i, q->given_j, swapped, &b)
                                            : bridge_form(kind, q->radius_i, other, q->given_i, q->given_j, swapped, &b);
    if (status != BRIDGE_OK) return status;
    memcpy(state, &b, sizeof b);
    state[WET_ANGLE_I] = s->angle[0];
    state[WET_ANGLE_J] = s->angle[c.j >= 0 ? 0 : wet_is_deck(s, c.j) ? 1 : 2];
    state[WET_IS_WALL] = c.j < 0;
    if (dem_add_link(w, c.i, c.j, c.element, state) != DEM_OK) return BRIDGE_INVALID;
    wet_tell_contact(w, number, &b);
    return BRIDGE_OK;
}

/* New contacts: between bodies that a bridge joins already, or asking for one. */
static void wet_born(dem_world *w, const int32_t *numbers, ptrdiff_t n, void *user) {
    wet_scene *s = user;
    bridge_contact *wanted = malloc((size_t)n * sizeof *wanted);
    int32_t *asking = malloc((size_t)n * sizeof *asking);
    size_t count = 0;
    if (!wanted || !asking) s->status = BRIDGE_INVALID;
    for (ptrdiff_t k = 0; k < n && s->status == BRIDGE_OK; k++) {
        const dem_contact_info c = dem_get_contact(w, numbers[k]);
        const ptrdiff_t link = dem_find_link(w, c.i, c.j, c.element);
        int swapped;
        if (link >= 0) {
            bridge b;
            memcpy(&b, dem_get_link(w, link).state, sizeof b);
            wet_tell_contact(w, numbers[k], &b);
            continue;
        }
        bridge_contact *q = &wanted[count];
        asking[count++] = numbers[k];
        memset(q, 0, sizeof *q);
        q->i = (size_t)w->id[c.i];
        q->j = c.j >= 0 ? (size_t)w->id[c.j] : wet_patch(s, w, &c);
        q->partner = wet_partner(w, &c);
        q->radius_i = dem_radius(w, c.i);
        q->radius_j = c.j >= 0 ? dem_radius(w, c.j) : q->partner == BRIDGE_WIRE ? 0.5 * w->wall[-1 - c.j].wire : (double)INFINITY;
        bridge_volume_range(wet_kind(s, w, &c, &swapped), q->radius_i, c.j >= 0 ? q->radius_j : (double)INFINITY, &q->volume_min,
                            &q->volume_max);
    }
    if (count > 0 && bridge_allocate(&s->films, wanted, count) != BRIDGE_OK) s->status = BRIDGE_INVALID;
    for (size_t k = 0; k < count && s->status == BRIDGE_OK; k++) {
        if (wanted[k].given_i + wanted[k].given_j > 0.0) s->status = wet_link(s, w, asking[k], &wanted[k]);
    }
    free(wanted);
    free(asking);
}

static void wet_ended(dem_world *w, int32_t number, void *user) {
    wet_scene *s = user;
    const dem_contact_info c = dem_get_link(w, number);
    bridge b;
    memcpy(&b, c.state, sizeof b);
    const size_t j = c.j >= 0 ? (size_t)w->id[c.j] : wet_patch(s, w, &c);
    if (bridge_release(&s->films, &b, (size_t)w->id[c.i], j, wet_partner(w, &c)) != BRIDGE_OK) s->status = BRIDGE_INVALID;
    s->ruptures++;
}

static const dem_law wet_law = {
    "linear, friction, rolling, lubrication", 2, WET_STATES, 3, 1, DEM_LINEAR_CONSTANTS, dem_prepare_linear, wet_force, wet_born, NULL};
static const dem_law wet_law_printed = {
    "linear, friction, rolling, lubrication, eqs 12-18 as printed", 2, WET_STATES, 3, 1, DEM_LINEAR_CONSTANTS, dem_prepare_linear, wet_force_printed, wet_born, NULL};
static const dem_law wet_bridges = {"liquid bridges", 1, WET_LINK_STATES, 0, 0, 0, NULL, wet_link_force, NULL, wet_ended};
static const dem_law wet_bridges_printed = {
    "liquid bridges, eqs 12-18 as printed", 1, WET_LINK_STATES, 0, 0, 0, NULL, wet_link_force_printed, NULL, wet_ended};
DEM_KERNEL(wet_kernel, wet_law, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING)
DEM_KERNEL(wet_kernel_energy, wet_law, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY)
DEM_KERNEL(wet_kernel_printed, wet_law_printed, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING)
DEM_LINK_KERNEL(wet_link_kernel, wet_bridges)
DEM_LINK_KERNEL(wet_link_kernel_printed, wet_bridges_printed)

/* features: DEM_ENERGY for the ledger, with the corrected laws only; the rest is always on. */
static inline dem_status wet_run(dem_world *w, double duration, int features) {
    const wet_scene *s = w->user;
    const dem_kernel *kernel = s->printed ? &wet_kernel_printed : features & DEM_ENERGY ? &wet_kernel_energy : &wet_kernel;
    const dem_status status = dem_run_law(w, duration, kernel);
    return status == DEM_OK && s->status != BRIDGE_OK ? DEM_BAD_ARGUMENT : status;
}

/* Liquid in films and bridges [m3]; number of bridges. */
static inline double wet_total(const wet_scene *s, const dem_world *w, int *bridges) {
    double volume = 0.0;
    *bridges = (int)dem_link_count(w);
    for (ptrdiff_t k = 0; k < dem_link_count(w); k++)
        volume += dem_get_link(w, k).state[0]; /* multiples of the quantum: exact in any order */
    return volume + bridge_films_total(&s->films);
}

/* Contact angles of water on walls [rad] (E&K 2019, Table 2). */
static const double WET_STEEL = 45.0 / 180.0 * RIDDLE_PI, WET_PVC = 50.0 / 180.0 * RIDDLE_PI;

/* Tables of bridges for grains of three sizes and for walls. */
static inline bridge_status wet_prepare_kinds(wet_scene *s, const double *class_diameter) {
    for (int a = 0; a < WET_CLASSES; a++) {
        for (int b = a; b < WET_PARTNERS; b++) {
            bridge_pair_def def = bridge_pair_default_def();
            def.radius_i = 0.5 * class_diameter[a];
            def.radius_j = b >= WET_DECK ? (double)INFINITY : 0.5 * class_diameter[b];
            def.angle_i = s->angle[0];
            def.angle_j = s->angle[b == WET_DECK ? 1 : b == WET_SIDE ? 2 : 0];
            if (b >= WET_DECK) def.volume_max = 0.02;
            def.liquid = s->liquid;
            const bridge_status status = bridge_pair_prepare(&s->kind[a][b], &def);
            if (status != BRIDGE_OK) return status;
        }
    }
    return BRIDGE_OK;
}

/* Dry books for at most n particles with ids from 0 (class by id: group, of three sizes) and dry walls; `decks` walls from `deck` on are
   screens or what stands in their place. volume: about all the liquid that there will be [m3]; side_angle: contact angle of the other
   walls [rad]. Free with wet_free. */
static inline bridge_status wet_prepare(wet_scene *s, int n, const int *group, const double *class_diameter, double volume, int deck,
                                        int decks, dem_world *w, bool printed, double side_angle) {
    double reach = 0.0, pitch = HUGE_VAL;
    memset(s, 0, sizeof *s);
    s->group = group;
    s->deck = deck, s->decks = decks;
    s->printed = printed;
    s->angle[0] = 15.0 / 180.0 * RIDDLE_PI, s->angle[1] = WET_STEEL, s->angle[2] = side_angle;
    s->patch = 5e-3;
    s->liquid = bridge_pair_default_def().liquid;
    for (int k = 0; k < w->walls; k++) {
        const dem_wall *wall = &w->wall[k];
        if (wall->kind == DEM_CYLINDER || wall->kind == DEM_CONE) s->wall_radius = wall->radius;
        if (wall->kind == DEM_SCREEN) reach = fmax(reach, fmax(wall->half_x, wall->half_y));
    }
    reach = fmax(reach, s->wall_radius);
    for (int k = deck; k < deck + decks; k++) pitch = fmin(pitch, wet_pitch(s, w, k));
    s->around = (int)(2.0 * RIDDLE_PI * s->wall_radius / s->patch) + 1;
    s->up = 30;
    s->bars = 2 * ((int)(reach / pitch) + 2);
    const bridge_status status = wet_prepare_kinds(s, class_diameter);
    if (status != BRIDGE_OK) return status;
    const size_t sides = (size_t)(s->around * s->up), a_deck = 2 * (size_t)s->bars * (size_t)s->bars,
                 patches = sides + (size_t)decks * a_deck;
    double *block = calloc(2 * ((size_t)n + patches) + patches, sizeof *block);
    if (!block) return BRIDGE_INVALID;
    bridge_films *f = &s->films;
    double *patch_area = block + 2 * ((size_t)n + patches);
    f->particle = block, f->n_particles = (size_t)n;
    f->patch = block + n, f->n_patches = patches;
    f->scratch = block + (size_t)n + patches;
    for (size_t k = 0; k < patches; k++) {
        const int wall = k < sides ? -1 : deck + (int)((k - sides) / a_deck);
        patch_area[k] = wall < 0 || !wet_has_wires(w, wall) ? s->patch * s->patch : wet_pitch(s, w, wall) * w->wall[wall].wire;
    }
    f->patch_area = patch_area;
    f->quantum = bridge_quantum(volume > 0.0 ? volume : 1e-6);
    return dem_set_links(w, printed ? &wet_link_kernel_printed : &wet_link_kernel, WET_INTERVAL, WET_NEAR) == DEM_OK ? BRIDGE_OK
                                                                                                                     : BRIDGE_INVALID;
}

/* A batch of n particles (class and diameter by id) with an equal film of liquid on each, `moisture` times their mass; dry walls,
   those that are no deck with a contact angle of side_angle [rad]. Free with wet_free. */
static inline bridge_status wet_init(wet_scene *s, int n, const int *group, const double *diameter, const double *class_diameter,
                                     double moisture, double particle_mass, int deck, dem_world *w, bool printed, double side_angle) {
    const double volume = moisture * particle_mass / 1000.0;
    const bridge_status status = wet_prepare(s, n, group, class_diameter, volume, deck, 1, w, printed, side_angle);
    if (status != BRIDGE_OK) return status;
    double area = 0.0;
    for (int i = 0; i < n; i++) area += RIDDLE_PI * diameter[i] * diameter[i];
    for (int i = 0; i < n; i++)
        s->films.particle[i] = bridge_quantised(volume * RIDDLE_PI * diameter[i] * diameter[i] / area, s->films.quantum);
    s->initial = bridge_films_total(&s->films);
    return BRIDGE_OK;
}

static inline void wet_free(wet_scene *s) {
    free(s->films.particle);
    memset(s, 0, sizeof *s);
}

#endif
