/* Woven screens: two families of bars, round or half-round. Each bar is an element. */
#pragma once
#include "add.h"

/* Computes the vector `from`, in (along, across, up), from the nearest point of the axis of bar `index` of a family, at
   (index - 1/2) pitch, to a centre. along: the centre's coordinate parallel to the bars; across: in the deck,
   perpendicular to them. Returns how far the surface is from that point [m]; < 0 if there is no such bar. */
DEM_INLINE double dem__reach_bar(const dem_wall *w, int family, double index, double along, double across, double up,
                                 dem_vec *from) {
    const double half = 0.5 * w->wire, bar = (index - 0.5) * (w->aperture + w->wire);
    const double side = family ? w->half_x : w->half_y, length = family ? w->half_y : w->half_x;
    const double end2 =
        w->circular ? (w->half_x - bar) * (w->half_x + bar) : length * length; /* square of its half length */
    const int beyond = !(along * along <= end2);
    const double da = !beyond ? 0.0 : along < 0.0 ? along + sqrt(end2) : along - sqrt(end2), dc = across - bar;
    *from = dem_vec3(da, dc, up);
    if (w->circular ? !(fabs(bar) < w->half_x) : !(fabs(bar) <= side)) return -1.0;
    if (w->profile == DEM_ROUND || !(up < 0.0)) return half;
    /* the flat side is as wide as the wire; from below, its ends are round */
    if (!beyond) {
        from->y = dc - dem__clamp(dc, -half, half);
        return 0.0;
    }
    const double out_by = sqrt(da * da + dc * dc), rest = out_by > half ? (out_by - half) / out_by : 0.0;
    from->x = rest * da, from->y = rest * dc;
    return 0.0;
}

/* Computes the touch with bar `index` of a family. Its normal is in (along, across, up). Returns 0 if there is no such
   bar. */
DEM_INLINE int dem__touch_bar(const dem_wall *w, int family, double index, double along, double across, double up,
                              double radius, dem__touch *out) {
    dem_vec from;
    const double inner = dem__reach_bar(w, family, index, along, across, up, &from);
    if (!(inner >= 0.0)) return 0;
    const double distance = dem__length(from);
    out->gap = distance - inner - radius;
    out->curvature =
        1.0 / w->wire; /* that of the round part everywhere, so that a contact's constants do not depend on where it
                          begins */
    out->normal = dem__scale(1.0 / distance, from);
    out->element = 2 * (int32_t)index + family;
    return distance > 0.0;
}

/* Transforms a vector from (along, across, up) of a family to the world's axes. */
DEM_INLINE dem_vec dem__from_bar(const dem_wall *w, int family, dem_vec v) {
    const dem_vec a = dem__scale(v.x, w->axis[family]), c = dem__scale(v.y, w->axis[1 - family]),
                  u = dem__scale(v.z, w->axis[2]);
    return dem__add(dem__add(a, c), u);
}

/* Returns the index of the first of the two nearest bars of a family; the second is the next one. Beside the deck, the
   last two bars. */
DEM_INLINE double dem__nearest_bar(const dem_wall *w, int family, double across) {
    const double pitch = w->aperture + w->wire, half = family ? w->half_x : w->half_y,
                 nearest = floor(across / pitch + 0.5);
    if (fabs(across) < half - pitch) return nearest;
    const double last = floor(half / pitch + 0.5);
    return dem__clamp(nearest, 1.0 - last, last - 1.0);
}

/* Returns a lower limit of the gap to all other bars [m]. lowest: the smallest gap found, which counts where it is
   negative. */
DEM_INLINE double dem__third_bar(const dem_wall *w, double radius, double lowest) {
    const double pitch = w->aperture + w->wire, sum = radius + 0.5 * w->wire, near = lowest < 0.0 ? sum + lowest : sum;
    return sqrt(near * near + 0.75 * pitch * pitch) - sum;
}

static inline int dem__touch_screen(const dem_wall *w, dem_vec d, double radius, double limit, dem__touch *out,
                                    double *least) {
    const double up = dem__dot(d, w->axis[2]);
    int n = 0;
    *least = fabs(up) - radius - 0.5 * w->wire;
    if (!(*least < limit)) return 0;
    double bound = HUGE_VAL;
    for (int family = 0; family < 2; family++) {
        const double along = dem__dot(d, w->axis[family]), across = dem__dot(d, w->axis[1 - family]);
        const double nearest = dem__nearest_bar(w, family, across);
        if (!(fabs(nearest) < 1e6)) continue;
        for (int side = 0; side < 2; side++) {
            if (!dem__touch_bar(w, family, nearest + side, along, across, up, radius, &out[n])) continue;
            bound = out[n].gap < bound ? out[n].gap : bound;
            if (!(out[n].gap < limit)) continue;
            out[n].normal = dem__from_bar(w, family, out[n].normal);
            n++;
        }
    }
    const double third = dem__third_bar(w, radius, bound);
    bound = third < bound ? third : bound;
    *least = bound > *least ? bound : *least;
    return n;
}

/* Finds the family and the index of a bar from the index of the element. */
DEM_INLINE int dem__family_of(int32_t element) { return (int)((uint32_t)element & 1u); }
DEM_INLINE double dem__index_of(int32_t element) { return (double)((element - dem__family_of(element)) / 2); }

static inline void dem__touch_element_of_screen(const dem_wall *w, dem_vec d, double radius, int32_t element,
                                                dem__touch *out) {
    const int family = dem__family_of(element);
    out->gap = HUGE_VAL, out->curvature = 0.0, out->normal = w->axis[2];
    if (dem__touch_bar(w, family, dem__index_of(element), dem__dot(d, w->axis[family]),
                       dem__dot(d, w->axis[1 - family]), dem__dot(d, w->axis[2]), radius, out))
        out->normal = dem__from_bar(w, family, out->normal);
}

static inline double dem__reach_screen(const dem_wall *w, dem_vec d, int32_t element, dem_vec *from, double *inner) {
    const int family = dem__family_of(element);
    const double along = dem__dot(d, w->axis[family]), across = dem__dot(d, w->axis[1 - family]),
                 up = dem__dot(d, w->axis[2]);
    *inner = dem__reach_bar(w, family, dem__index_of(element), along, across, up, from);
    *from = dem__from_bar(w, family, *from);
    return *inner >= 0.0 && dem__dot(*from, *from) > 0.0 ? 1.0 : 0.0;
}

static inline dem_vec dem__turn_at_screen(const dem_wall *w, dem_vec d, double radius, int32_t element, dem_vec n,
                                          double inverse, dem_vec u) {
    const dem_vec along = w->axis[dem__family_of(element)], side = dem__sub(u, dem__scale(dem__dot(u, n), n));
    (void)d, (void)radius;
    if (fabs(dem__dot(n, along)) > 1e-9) return dem__scale(inverse, side); /* at a bar's end */
    if (w->profile == DEM_SEMICIRCLE && dem__dot(n, w->axis[2]) <= 1e-12 - 1.0)
        return dem_vec3(0.0, 0.0, 0.0); /* its flat side */
    return dem__scale(inverse, dem__plus(side, -dem__dot(side, along), along));
}

/* Finds the ends of a bar's axis, from the screen's origin. Returns 0 if there is no such bar. */
static inline int dem__bar_ends(const dem_wall *w, int family, double index, dem_vec end[2]) {
    const double bar = (index - 0.5) * (w->aperture + w->wire), length = family ? w->half_y : w->half_x;
    dem_vec from;
    if (dem__reach_bar(w, family, index, 0.0, bar, 0.0, &from) < 0.0) return 0;
    const double reach = w->circular ? sqrt((w->half_x - bar) * (w->half_x + bar)) : length;
    for (int k = 0; k < 2; k++) end[k] = dem__from_bar(w, family, dem_vec3(k ? reach : -reach, bar, 0.0));
    return 1;
}
/* Finds the first and the last bar of a family near a polyhedron at d. reach: of the polyhedron [m]. */
DEM_INLINE void dem__bars_near(const dem_wall *w, int family, dem_vec d, double reach, double *first, double *last) {
    const double pitch = w->aperture + w->wire, across = dem__dot(d, w->axis[1 - family]),
                 half = family ? w->half_x : w->half_y;
    const double low = dem__clamp(across - reach - 0.5 * w->wire, -half, half);
    const double high = dem__clamp(across + reach + 0.5 * w->wire, -half, half);
    *first = floor(low / pitch + 0.5), *last = floor(high / pitch + 0.5);
}

/* Presents the edges of a bar and its ends to a visitor. A half-round bar is a capsule when touched from above, and two
   sharp edges when touched from below. */
static inline void dem__show_bar(const dem_wall *w, int family, double index, dem_vec d, dem__edge_visitor *v) {
    const double half = 0.5 * w->wire;
    const int32_t key = DEM__ELEMENT_KEYS * (2 * (int32_t)index + family + DEM__ELEMENTS_FROM) + DEM_CORNERS_MAX;
    const dem_vec none = dem_vec3(0.0, 0.0, 0.0);
    dem__wall_edge e, below;
    dem_vec end[2];
    if (!dem__bar_ends(w, family, index, end)) return;
    for (int k = 0; k < 2; k++) end[k] = dem__sub(end[k], d);
    for (int k = 0; k < 2; k++) v->corner(v, end[k], half, none, key + k);
    memset(&e, 0, sizeof e);
    e.from = end[0], e.to = end[1], e.radius = half, e.ends = 3, e.is_axis = 1, e.key = key + 2;
    e.side = w->axis[2], e.sign = w->profile == DEM_ROUND ? 0.0 : 1.0;
    v->edge(v, &e);
    for (int side = -1; side < 2 && w->profile != DEM_ROUND; side += 2) {
        const dem_vec off = dem__scale(side * half, w->axis[1 - family]);
        memset(&below, 0, sizeof below);
        below.from = dem__add(end[0], off), below.to = dem__add(end[1], off);
        below.key = key + 2 + DEM__EDGE_KEYS * (side > 0 ? 2 : 1);
        below.side = w->axis[2], below.sign = -1.0;
        v->edge(v, &below);
    }
}
static inline void dem__screen_edges(const dem_wall *w, dem_vec centre, double reach, dem__edge_visitor *v) {
    const dem_vec d = dem__sub(centre, w->position);
    double first, last;
    for (int family = 0; family < 2; family++) {
        dem__bars_near(w, family, d, reach, &first, &last);
        for (double index = first; index <= last; index += 1.0) dem__show_bar(w, family, index, d, v);
    }
}

/* Returns what is wrong with a screen, or NULL: it has lengths, and no more bars and apertures than integers count. */
static inline const char *dem__wrong_deck(const dem_wall *w) {
    const double pitch = w->aperture + w->wire, x = w->half_x / pitch, y = w->half_y / pitch;
    if (w->profile != DEM_ROUND && w->profile != DEM_SEMICIRCLE)
        return "screen.profile: neither DEM_ROUND nor DEM_SEMICIRCLE";
    if (!dem__positive(w->aperture)) return "screen.aperture: not a finite number above 0";
    if (!dem__positive(w->wire)) return "screen.wire: not a finite number above 0";
    if (!(x > 0.0 && x < 1e5)) return "screen.half_x: not above 0, or 1e5 meshes or more";
    if (!(y > 0.0 && y < 1e5)) return "screen.half_y: not above 0, or 1e5 meshes or more";
    return x * y < 2.5e8 ? NULL : "screen.half_x, half_y: too many apertures";
}
static inline int dem__is_deck(const dem_wall *w) { return !dem__wrong_deck(w); }

static inline const dem__wall_kind *dem__woven_screen(void) {
    static const dem__wall_kind row = {
        DEM_SCREEN,                   /* kind */
        DEM__CONVEX,                  /* flags: of each bar */
        dem__is_deck,                 /* is_sound */
        dem__touch_screen,            /* touch */
        dem__touch_element_of_screen, /* touch_element */
        dem__third_bar,               /* other_elements */
        dem__reach_screen,            /* reach_round */
        dem__turn_at_screen,          /* normal_rate */
        NULL,                         /* is_endless */
        NULL,                         /* closing */
        NULL,                         /* corners */
        dem__screen_edges,            /* edges */
        NULL                          /* crosses */
    };
    return &row;
}

DEM_API dem_screen dem_default_screen(void) {
    dem_screen s;
    memset(&s, 0, sizeof s);
    s.aperture = 8e-3;
    s.wire = 2e-3;
    s.profile = DEM_SEMICIRCLE;
    s.circular = 1;
    s.half_x = s.half_y = 0.095;
    s.normal = dem_vec3(0, 0, 1);
    s.direction = dem_vec3(1, 0, 0);
    return s;
}

DEM_API int dem_add_screen(dem_world *world, int material, const dem_screen *screen) {
    dem_wall wall;
    const dem_status status = dem__may_add_wall(world, material);
    memset(&wall, 0, sizeof wall);
    if (status != DEM_OK) return -(int)status;
    if (!screen) return -(int)dem__refuse(world, "screen: NULL");
    if (!dem__is_place(screen->centre))
        return -(int)dem__refuse(world, "screen.centre: a coordinate is not finite or above 1e150");
    if (!dem__finite_vec(screen->direction)) return -(int)dem__refuse(world, "screen.direction: not finite");
    if (!dem__finite_vec(screen->normal) || !dem__frame(&wall, screen->normal, screen->direction))
        return -(int)dem__refuse(world, "screen.normal: not finite, or of length 0");
    wall.asked.origin = screen->centre;
    wall.aperture = screen->aperture;
    wall.wire = screen->wire;
    wall.profile = (int)screen->profile;
    wall.circular = screen->circular != 0;
    wall.half_x = screen->half_x;
    wall.half_y = screen->circular ? screen->half_x : screen->half_y;
    const char *wrong = dem__wrong_deck(&wall);
    if (wrong) return -(int)dem__refuse(world, wrong);
    return dem__add_wall(world, dem__woven_screen(), material, &wall);
}
