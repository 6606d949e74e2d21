/* dem_wet.h: liquid bridges in a dem.h world: the dry linear law with friction and rolling, and the bridges of
   liquid_bridge.h.

   #include "dem_wet.h"

   int main(void) {
       double centre[] = {0, 0, 0.0025, 0.005, 0, 0.0025}, diameter[] = {0.005, 0.005};
       double size[WET_CLASSES] = {0.005, 0.005, 0.005};
       int group[] = {0, 0}, bridges;                                           // size class of each sphere, by id
       dem_def def = dem_default_def();
       const int glass = dem_add_material(&def, 2500.0, 5e6, 0.3);
       dem_world world;
       wet_scene water;
       if (dem_init(&world, &def, NULL) != DEM_OK) return 1;
       const int floor_wall = dem_add_plane(&world, glass, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
       dem_add_spheres(&world, 2, centre, diameter, glass, 0);
       if (wet_init(&water, 2, group, diameter, size, 0.01, 3.3e-4, floor_wall, &world, 0, WET_STEEL) != BRIDGE_OK)
           return 1;
       world.user = &water;
       const dem_status status = wet_run(&world, 1e-3, 0);
       const double volume = wet_total(&water, &world, &bridges);               // in films and bridges [m3]
       wet_free(&water);
       dem_free(&world);
       return status != DEM_OK || !(volume > 0.0);
   }

   Model    Spheres and walls carry films. A bridge forms when two bodies touch and lives until its gap is beyond
            dynamic rupture. It is a link of dem.h: capillary force and viscous resistance change little in
            WET_INTERVAL, so that links are evaluated once in many steps. The resistance below the gap WET_NEAR grows as
            1/gap; it belongs to the contact. Equations: liquid_bridge.h.
   Films    of a particle by its id; of walls by patches: 5 mm squares of a side wall, a pitch of a wire. The sum of
            films and bridges is exact: all volumes are multiples of one quantum.
   Units    SI; angles in rad.
   Memory   from the world's allocator; wet_free gives it back. The arrays group and class_diameter stay the caller's;
            group must live as long as the scene.
   Errors   bridge_status. What goes wrong within a run stands in scene.status, and wet_run returns DEM_BAD_ARGUMENT.
   Threads  those of dem.h. Bits: as dem.h.
   Linking  with dem.h and liquid_bridge.h beside it. Every function is static inline; for one shared copy #define
            WET_API extern before every inclusion, and WET_IMPLEMENTATION as well in one file, which has the bodies of
            dem.h, too: kernels are compiled there. The other two have their own switches.
   Not here more than three size classes, liquid that flows along a wall, polyhedra. */
#ifndef RIDDLE_DEM_WET_H
#define RIDDLE_DEM_WET_H

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "dem_wet.h needs NaN and infinity: compile without -ffast-math"
#endif

#include "dem.h"
#include "liquid_bridge.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#ifndef WET_API
#define WET_API static inline
#define WET__BODIES
#elif defined(WET_IMPLEMENTATION)
#define WET__BODIES
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ================================================= >>declarations ================================================= */

/* State of a contact behind its friction history: the bridge's width and radius (0: dry). */
enum { WET_WIDTH = 3, WET_RADIUS, WET_STATES };
/* State of a link: the bridge; for the printed equations also the contact angles, and 1 if j is a wall. */
enum {
    WET_BRIDGE_SIZE = sizeof(bridge) / sizeof(double),
    WET_ANGLE_I = WET_BRIDGE_SIZE,
    WET_ANGLE_J,
    WET_IS_WALL,
    WET_LINK_STATES
};
enum {
    WET_CLASSES = 3,
    WET_DECK = WET_CLASSES,
    WET_SIDE,
    WET_PARTNERS
};                                                        /* walls by their contact angle: decks, others */
static const double WET_INTERVAL = 2e-4, WET_NEAR = 2e-6; /* between evaluations of links [s]; gap [m] */

typedef struct wet_scene {
    bridge_liquid liquid;
    double angle[3];                             /* contact angle of particles, of decks, of other walls [rad] */
    bool printed;                                /* eqs 12-18 as printed */
    bridge_pair kind[WET_CLASSES][WET_PARTNERS]; /* classes a <= b, or a wall */
    bridge_films films;
    const int *group; /* class of particle by id */
    int deck, decks;  /* wall index of the first screen, or of what stands in its place; how many there are */
    double patch, wall_radius;
    int around, up,
        bars; /* patches of the side wall; bars of a family, patches of a bar; without wires patches are one family */
    long long ruptures;
    double initial;          /* liquid at the start [m3] */
    bridge_status status;    /* what went wrong within a run */
    dem_allocator allocator; /* of films and patches */
    size_t bytes;
} wet_scene;

/* Contact angles of water on walls [rad] (E&K 2019, Table 2). */
static const double WET_STEEL = 45.0 / 180.0 * RIDDLE_PI, WET_PVC = 50.0 / 180.0 * RIDDLE_PI;

/* Dry books for at most n >= 0 particles with ids from 0 and dry walls. group: size class 0..2 by id, shape [n], to be
   set before a particle touches anything. class_diameter: of the three classes [m] > 0, shape [WET_CLASSES]. volume:
   about all the liquid that there will be [m3] >= 0. `decks` walls from wall `deck` on are screens or what stands in
   their place. No wall has more than 1000 patches across.
   printed: the laws of Elskamp & Kruggel-Emden (2019), eqs 12-18, as printed. side_angle: contact angle of the other
   walls [rad].
   BRIDGE_INVALID: an argument, or no memory; nothing is held then. */
WET_API bridge_status wet_prepare(wet_scene *s, int n, const int *group, const double *class_diameter, double volume,
                                  int deck, int decks, dem_world *w, bool printed, double side_angle);

/* The same, and an equal film on each of n particles of one batch, in all `moisture` [-] >= 0 times their mass
   [kg] > 0. diameter: by id [m] > 0, shape [n]. One deck. */
WET_API bridge_status wet_init(wet_scene *s, int n, const int *group, const double *diameter,
                               const double *class_diameter, double moisture, double particle_mass, int deck,
                               dem_world *w, bool printed, double side_angle);

WET_API void wet_free(wet_scene *s); /* safe on a zeroed or freed one */

/* dem_run_law with bridges; world->user is the wet_scene. features: DEM_ENERGY for the ledger, with the corrected laws
   only; the rest is always on. */
WET_API dem_status wet_run(dem_world *w, double duration, int features);

/* Liquid in films and bridges [m3]. bridges: how many there are; may be NULL. */
WET_API double wet_total(const wet_scene *s, const dem_world *w, int *bridges);

/* Computes the tables of bridges again, for three sizes [m] and for walls. Call it after s->angle or s->liquid has
   changed. */
WET_API bridge_status wet_prepare_kinds(wet_scene *s, const double *class_diameter);

/* ===================================================== >>laws ===================================================== */

/* What the kernels inline: without branches, so that their loops vectorise. */

/* Normal, translation and spin resistance at a gap [N s/m], or none: share 1 or 0. */
DEM_INLINE void wet__resistance(const bridge *b, const bridge_liquid *liquid, double gap, bool printed, double share,
                                double *resistance) {
    const bridge_resistances r = bridge_resistance(b, liquid, gap);
    const double rs = 0.5 * b->radius, sv = bridge_viscous_gap(gap, rs, liquid->roughness);
    resistance[0] = share * r.normal;
    resistance[1] = share * (printed ? bridge_printed_drag_translation(sv, rs, liquid->viscosity) : r.tangential);
    resistance[2] = share * (printed ? bridge_printed_drag_spin(sv, rs, liquid->viscosity) : r.tangential);
}

DEM_INLINE void wet__resist(const dem_contact *c, const double *resistance, dem_response *r) {
    r->normal += resistance[0] * c->closing;
    r->rolling_power += resistance[0] * c->closing * c->closing;
    for (int a = 0; a < 3; a++) {
        const double drag = resistance[1] * c->translation[a] + resistance[2] * (c->slip[a] - c->translation[a]);
        r->remaining[a] = -drag;
        r->tangential[a] -= drag;
        r->rolling_power += drag * c->slip[a];
    }
}

DEM_INLINE void wet__contact_force(const dem_contact *c, double *state, dem_response *r, bool printed) {
    const bridge_liquid liquid = ((const wet_scene *)c->user)->liquid;
    const double radius = state[WET_RADIUS] > 0.0 ? state[WET_RADIUS] : 1.0, wet = state[WET_RADIUS] > 0.0 ? 1.0 : 0.0;
    const double near = c->gap < WET_NEAR ? 1.0 : 0.0;
    const bridge b = {0.0, state[WET_WIDTH], 0.0, radius, 0.0, {0.0}};
    double resistance[3];
    dem_force_linear_rolling(c, state, r);
    wet__resistance(&b, &liquid, c->gap, printed, wet * near, resistance);
    wet__resist(c, resistance, r);
    /* linked spheres stay in contact as long as they are near; a dry contact ends with the overlap, as the dry law
       says */
    r->ended = wet > 0.0 ? 1.0 - near : r->ended;
}
DEM_INLINE void wet__force(const dem_contact *c, double *state, dem_response *r) {
    wet__contact_force(c, state, r, false);
}
DEM_INLINE void wet__force_printed(const dem_contact *c, double *state, dem_response *r) {
    wet__contact_force(c, state, r, true);
}

DEM_INLINE void wet__bridge_force(const dem_contact *c, double *state, dem_response *r, bool printed) {
    const double *s = state;
    const bridge_liquid liquid = ((const wet_scene *)c->user)->liquid;
    const bridge b = {s[0], s[1], s[2], s[3], s[4], {s[5], s[6], s[7], s[8], s[9], s[10], s[11]}};
    const double gap = c->gap > 0.0 ? c->gap : 0.0;
    double resistance[3], pull;
    if (printed)
        pull = s[WET_IS_WALL] > 0.0 ? bridge_printed_force_wall(gap, b.volume, 0.5 * b.radius, s[WET_ANGLE_I],
                                                                s[WET_ANGLE_J], liquid.surface_tension)
                                    : bridge_printed_force(gap, b.volume, b.radius, s[WET_ANGLE_I], s[WET_ANGLE_J],
                                                           liquid.surface_tension);
    else pull = bridge_attraction(&b, c->gap);
    wet__resistance(&b, &liquid, gap, printed, c->gap < WET_NEAR ? 0.0 : 1.0, resistance);
    r->normal = -pull;
    r->tangential[0] = r->tangential[1] = r->tangential[2] = r->rolling_power = 0.0;
    wet__resist(c, resistance, r);
    r->ended = bridge_is_ruptured(&b, &liquid, c->gap, -c->closing) ? 1.0 : 0.0;
}
DEM_INLINE void wet__link_force(const dem_contact *c, double *state, dem_response *r) {
    wet__bridge_force(c, state, r, false);
}
DEM_INLINE void wet__link_force_printed(const dem_contact *c, double *state, dem_response *r) {
    wet__bridge_force(c, state, r, true);
}

/* ===================================================== >>books ==================================================== */

static inline bool wet__is_deck(const wet_scene *s, ptrdiff_t j) {
    return -1 - j >= s->deck && -1 - j < s->deck + s->decks;
}
static inline bool wet__has_wires(const dem_world *w, int wall) { return w->wall[wall].kind == DEM_SCREEN; }
static inline double wet__pitch(const wet_scene *s, const dem_world *w, int wall) {
    return wet__has_wires(w, wall) ? w->wall[wall].aperture + w->wall[wall].wire : s->patch;
}

static inline double wet__larger(double a, double b) { return a > b ? a : b; }
/* Rounds towards zero, as (int) does within its range. */
static inline int wet__whole(double x) { return x > -1e9 ? x < 1e9 ? (int)x : 1000000000 : -1000000000; }

/* Which film patch of the walls a contact draws from: 5 mm squares of the side wall and of a deck without wires, one
   pitch of a bar. */
static inline size_t wet__patch(const wet_scene *s, const dem_world *w, const dem_contact_info *c) {
    const int wall = (int)(-1 - c->j);
    const dem_vec at = dem_position(w, c->i), origin = w->wall[wall].position;
    const double x = at.x - origin.x, y = at.y - origin.y, z = at.z - origin.z;
    if (!wet__is_deck(s, c->j)) {
        const int a = wet__whole((riddle_atan2(y, x) / RIDDLE_PI + 1.0) * 0.5 * s->around),
                  u = wet__whole(z / s->patch) + 2;
        return (size_t)((a < 0            ? 0
                         : a >= s->around ? s->around - 1
                                          : a) +
                        s->around * (u < 0        ? 0
                                     : u >= s->up ? s->up - 1
                                                  : u));
    }
    const double pitch = wet__pitch(s, w, wall);
    const bool wires = wet__has_wires(w, wall);
    const int side = s->around * s->up + (wall - s->deck) * 2 * s->bars * s->bars;
    const int family = wires ? (int)((unsigned)c->element & 1u) : 0;
    const int bar = wires ? (c->element - family) / 2 + s->bars / 2 : wet__whole(y / pitch + s->bars / 2.0);
    const int segment = wet__whole((family ? y : x) / pitch + s->bars / 2.0);
    const int b = bar < 0          ? 0
                  : bar >= s->bars ? s->bars - 1
                                   : bar,
              k = segment < 0          ? 0
                  : segment >= s->bars ? s->bars - 1
                                       : segment;
    return (size_t)(side + (family * s->bars + b) * s->bars + k);
}

static inline bridge_partner wet__partner(const dem_world *w, const dem_contact_info *c) {
    return c->j >= 0 ? BRIDGE_SPHERE : wet__has_wires(w, (int)(-1 - c->j)) ? BRIDGE_WIRE : BRIDGE_WALL;
}

/* The prepared kind of a contact's pair; swapped: the contact's i is the kind's j. */
static inline const bridge_pair *wet__kind(const wet_scene *s, const dem_world *w, const dem_contact_info *c,
                                           int *swapped) {
    const int a = s->group[w->id[c->i]], b = c->j >= 0               ? s->group[w->id[c->j]]
                                             : wet__is_deck(s, c->j) ? WET_DECK
                                                                     : WET_SIDE;
    *swapped = a > b;
    return &s->kind[a < b ? a : b][a < b ? b : a];
}

/* Gives the contact of that number the data of its bridge. */
static inline void wet__tell_contact(dem_world *w, int32_t number, const bridge *b) {
    dem_contact_info c = dem_get_contact(w, number);
    c.state[WET_WIDTH] = b->width;
    c.state[WET_RADIUS] = b->radius;
    dem_set_contact_state(w, number, c.state);
}

static inline bridge_status wet__link(wet_scene *s, dem_world *w, int32_t number, const bridge_contact *q) {
    const dem_contact_info c = dem_get_contact(w, number);
    double state[WET_LINK_STATES];
    bridge b;
    int swapped;
    const bridge_pair *kind = wet__kind(s, w, &c, &swapped);
    const double other = c.j >= 0 ? q->radius_j : (double)INFINITY;
    const bridge_status status =
        s->printed ? bridge_form_printed(kind, q->radius_i, other, q->given_i, q->given_j, swapped, &b)
                   : bridge_form(kind, q->radius_i, other, q->given_i, q->given_j, swapped, &b);
    if (status != BRIDGE_OK) return status;
    memcpy(state, &b, sizeof b);
    state[WET_ANGLE_I] = s->angle[0];
    state[WET_ANGLE_J] = s->angle[c.j >= 0 ? 0 : wet__is_deck(s, c.j) ? 1 : 2];
    state[WET_IS_WALL] = c.j < 0;
    if (dem_add_link(w, c.i, c.j, c.element, state) != DEM_OK) return BRIDGE_INVALID;
    wet__tell_contact(w, number, &b);
    return BRIDGE_OK;
}

/* New contacts: between bodies that a bridge joins already, or asking for one. */
static inline void wet__born(dem_world *w, const int32_t *numbers, ptrdiff_t n, void *user) {
    wet_scene *s = (wet_scene *)user;
    const size_t bytes = (size_t)n * (sizeof(bridge_contact) + sizeof(int32_t));
    bridge_contact *wanted = (bridge_contact *)s->allocator.fn(s->allocator.user, NULL, 0, bytes);
    int32_t *asking = (int32_t *)(void *)(wanted + n);
    size_t count = 0;
    if (!wanted) {
        s->status = BRIDGE_INVALID;
        return;
    }
    for (ptrdiff_t k = 0; k < n && s->status == BRIDGE_OK; k++) {
        const dem_contact_info c = dem_get_contact(w, numbers[k]);
        const ptrdiff_t link = dem_find_link(w, c.i, c.j, c.element);
        int swapped;
        if (link >= 0) {
            bridge b;
            memcpy(&b, dem_get_link(w, link).state, sizeof b);
            wet__tell_contact(w, numbers[k], &b);
            continue;
        }
        bridge_contact *q = &wanted[count];
        asking[count++] = numbers[k];
        memset(q, 0, sizeof *q);
        q->i = (size_t)w->id[c.i];
        q->j = c.j >= 0 ? (size_t)w->id[c.j] : wet__patch(s, w, &c);
        q->partner = wet__partner(w, &c);
        q->radius_i = dem_radius(w, c.i);
        q->radius_j = c.j >= 0                    ? dem_radius(w, c.j)
                      : q->partner == BRIDGE_WIRE ? 0.5 * w->wall[-1 - c.j].wire
                                                  : (double)INFINITY;
        bridge_volume_range(wet__kind(s, w, &c, &swapped), q->radius_i, c.j >= 0 ? q->radius_j : (double)INFINITY,
                            &q->volume_min, &q->volume_max);
    }
    if (count > 0 && bridge_allocate(&s->films, wanted, count) != BRIDGE_OK) s->status = BRIDGE_INVALID;
    for (size_t k = 0; k < count && s->status == BRIDGE_OK; k++) {
        if (wanted[k].given_i + wanted[k].given_j > 0.0) s->status = wet__link(s, w, asking[k], &wanted[k]);
    }
    s->allocator.fn(s->allocator.user, wanted, bytes, 0);
}

static inline void wet__ended(dem_world *w, int32_t number, void *user) {
    wet_scene *s = (wet_scene *)user;
    const dem_contact_info c = dem_get_link(w, number);
    bridge b;
    memcpy(&b, c.state, sizeof b);
    const size_t j = c.j >= 0 ? (size_t)w->id[c.j] : wet__patch(s, w, &c);
    if (bridge_release(&s->films, &b, (size_t)w->id[c.i], j, wet__partner(w, &c)) != BRIDGE_OK)
        s->status = BRIDGE_INVALID;
    s->ruptures++;
}

static const dem_law wet_law = {"linear, friction, rolling, lubrication",
                                2,
                                WET_STATES,
                                3,
                                1,
                                DEM_LINEAR_CONSTANTS,
                                dem_prepare_linear,
                                wet__force,
                                wet__born,
                                NULL};
static const dem_law wet_law_printed = {"linear, friction, rolling, lubrication, eqs 12-18 as printed",
                                        2,
                                        WET_STATES,
                                        3,
                                        1,
                                        DEM_LINEAR_CONSTANTS,
                                        dem_prepare_linear,
                                        wet__force_printed,
                                        wet__born,
                                        NULL};
static const dem_law wet_bridges = {"liquid bridges", 1,    WET_LINK_STATES, 0, 0, 0, NULL,
                                    wet__link_force,  NULL, wet__ended};
static const dem_law wet_bridges_printed = {"liquid bridges, eqs 12-18 as printed",
                                            1,
                                            WET_LINK_STATES,
                                            0,
                                            0,
                                            0,
                                            NULL,
                                            wet__link_force_printed,
                                            NULL,
                                            wet__ended};

#ifdef WET__BODIES

/* ==================================================== >>bodies ==================================================== */

DEM_KERNEL(wet_kernel, wet_law, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING)
DEM_KERNEL(wet_kernel_energy, wet_law, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING | DEM_ENERGY)
DEM_KERNEL(wet_kernel_printed, wet_law_printed, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING)
DEM_LINK_KERNEL(wet_link_kernel, wet_bridges)
DEM_LINK_KERNEL(wet_link_kernel_printed, wet_bridges_printed)

WET_API dem_status wet_run(dem_world *w, double duration, int features) {
    const wet_scene *s = w ? (const wet_scene *)w->user : NULL;
    if (!s) return DEM_BAD_ARGUMENT;
    const dem_kernel *kernel = s->printed              ? &wet_kernel_printed
                               : features & DEM_ENERGY ? &wet_kernel_energy
                                                       : &wet_kernel;
    const dem_status status = dem_run_law(w, duration, kernel);
    return status == DEM_OK && s->status != BRIDGE_OK ? DEM_BAD_ARGUMENT : status;
}

WET_API double wet_total(const wet_scene *s, const dem_world *w, int *bridges) {
    double volume = 0.0;
    if (bridges) *bridges = (int)dem_link_count(w);
    for (ptrdiff_t k = 0; k < dem_link_count(w); k++)
        volume += dem_get_link(w, k).state[0]; /* multiples of the quantum: exact in any order */
    return volume + bridge_films_total(&s->films);
}

WET_API bridge_status wet_prepare_kinds(wet_scene *s, const double *class_diameter) {
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

WET_API bridge_status wet_prepare(wet_scene *s, int n, const int *group, const double *class_diameter, double volume,
                                  int deck, int decks, dem_world *w, bool printed, double side_angle) {
    double reach = 0.0, pitch = HUGE_VAL;
    if (!s) return BRIDGE_INVALID;
    memset(s, 0, sizeof *s);
    if (!w || !w->def.allocator.fn || !group || !class_diameter || n < 0 || !(volume >= 0.0 && volume <= DBL_MAX))
        return BRIDGE_INVALID;
    if (deck < 0 || decks < 0 || deck > w->walls - decks) return BRIDGE_INVALID;
    s->group = group;
    s->deck = deck, s->decks = decks;
    s->printed = printed;
    s->angle[0] = 15.0 / 180.0 * RIDDLE_PI, s->angle[1] = WET_STEEL, s->angle[2] = side_angle;
    s->patch = 5e-3;
    s->liquid = bridge_pair_default_def().liquid;
    for (int k = 0; k < w->walls; k++) {
        const dem_wall *wall = &w->wall[k];
        if (wall->kind == DEM_CYLINDER || wall->kind == DEM_CONE) s->wall_radius = wall->radius;
        if (wall->kind == DEM_SCREEN) reach = wet__larger(reach, wet__larger(wall->half_x, wall->half_y));
    }
    reach = wet__larger(reach, s->wall_radius);
    for (int k = deck; k < deck + decks; k++) pitch = -wet__larger(-pitch, -wet__pitch(s, w, k));
    if (!(reach <= 1000.0 * s->patch && reach <= 1000.0 * pitch)) return BRIDGE_INVALID;
    s->around = (int)(2.0 * RIDDLE_PI * s->wall_radius / s->patch) + 1;
    s->up = 30;
    s->bars = 2 * ((int)(reach / pitch) + 2);
    const bridge_status status = wet_prepare_kinds(s, class_diameter);
    if (status != BRIDGE_OK) return status;
    const size_t sides = (size_t)(s->around * s->up), a_deck = 2 * (size_t)s->bars * (size_t)s->bars,
                 patches = sides + (size_t)decks * a_deck;
    s->allocator = w->def.allocator;
    s->bytes = (2 * ((size_t)n + patches) + patches) * sizeof(double);
    double *block = (double *)s->allocator.fn(s->allocator.user, NULL, 0, s->bytes);
    if (!block) return BRIDGE_INVALID;
    memset(block, 0, s->bytes);
    bridge_films *f = &s->films;
    double *patch_area = block + 2 * ((size_t)n + patches);
    f->particle = block, f->n_particles = (size_t)n;
    f->patch = block + n, f->n_patches = patches;
    f->scratch = block + (size_t)n + patches;
    for (size_t k = 0; k < patches; k++) {
        const int wall = k < sides ? -1 : deck + (int)((k - sides) / a_deck);
        patch_area[k] =
            wall < 0 || !wet__has_wires(w, wall) ? s->patch * s->patch : wet__pitch(s, w, wall) * w->wall[wall].wire;
    }
    f->patch_area = patch_area;
    f->quantum = bridge_quantum(volume > 0.0 ? volume : 1e-6);
    if (dem_set_links(w, printed ? &wet_link_kernel_printed : &wet_link_kernel, WET_INTERVAL, WET_NEAR) == DEM_OK)
        return BRIDGE_OK;
    wet_free(s);
    return BRIDGE_INVALID;
}

WET_API bridge_status wet_init(wet_scene *s, int n, const int *group, const double *diameter,
                               const double *class_diameter, double moisture, double particle_mass, int deck,
                               dem_world *w, bool printed, double side_angle) {
    const double volume = moisture * particle_mass / 1000.0;
    for (int i = 0; i < n; i++)
        if (!group || !diameter || group[i] < 0 || group[i] >= WET_CLASSES ||
            !(diameter[i] > 0.0 && diameter[i] <= 1e9))
            n = -1;
    const bridge_status status = wet_prepare(s, n, group, class_diameter, volume, deck, 1, w, printed, side_angle);
    if (status != BRIDGE_OK) return status;
    double area = 0.0;
    for (int i = 0; i < n; i++) area += RIDDLE_PI * diameter[i] * diameter[i];
    for (int i = 0; i < n; i++)
        s->films.particle[i] =
            bridge_quantised(volume * RIDDLE_PI * diameter[i] * diameter[i] / area, s->films.quantum);
    s->initial = bridge_films_total(&s->films);
    return BRIDGE_OK;
}

WET_API void wet_free(wet_scene *s) {
    if (!s) return;
    if (s->films.particle) s->allocator.fn(s->allocator.user, s->films.particle, s->bytes, 0);
    memset(s, 0, sizeof *s);
}

#endif /* WET__BODIES */

#ifdef __cplusplus
}
#endif
#endif
