/* Signed distances of woven cloth, beds and voxel images. */
#pragma once
#include "solids_api.h"
#include "../base/base.h"
#include "../../base/portable_math.h"

/* ==== >>solids ==== */

/* Finds the sign change of the distance along a link by regula falsi, which halves the weight of an end that stays
   (Dowell and Jarratt 1971). */
FILTRATION_API double filtration_solid_cut(const filtration_solid *solid, const double fluid[3],
                                           const double in_solid[3]) {
    double low = 0.0, high = 1.0, point[3];
    if (!solid || !solid->distance || !fluid || !in_solid) return (double)NAN;
    double at_low = solid->distance(solid->self, fluid), at_high = solid->distance(solid->self, in_solid);
    if (!(at_low > 0.0 && at_high <= 0.0)) return (double)NAN;
    int side = 0;
    for (int i = 0; i < 60 && high - low > 1e-9; i++) {
        double q = at_high < 0.0 ? low + (high - low) * at_low / (at_low - at_high) : high;
        if (i % 3 == 2) q = 0.5 * (low + high); /* bisects every third time, which guarantees convergence */
        for (int a = 0; a < 3; a++) point[a] = fluid[a] + q * (in_solid[a] - fluid[a]);
        const double here = solid->distance(solid->self, point);
        if (here == 0.0) return q;
        if (here > 0.0) {
            low = q, at_low = here;
            if (side == 1) at_high *= 0.5;
            side = 1;
        } else {
            high = q, at_high = here;
            if (side == -1) at_low *= 0.5;
            side = -1;
        }
    }
    return 0.5 * (low + high);
}

/* ---- woven cloth ---- */

FILTRATION_API filtration_status filtration_cloth_make(filtration_cloth *cloth, double wire, double opening,
                                                       filtration_weave weave, double centre) {
    if (!cloth || !(wire > 0.0 && opening > 0.0 && filtration__is_finite(wire) && filtration__is_finite(opening)) ||
        !(wire + opening < 1e100 && fabs(centre) < 1e100) ||
        (weave != FILTRATION_PLAIN_WEAVE && weave != FILTRATION_TWILL_WEAVE))
        return FILTRATION_BAD_ARGUMENT;
    cloth->wire = wire, cloth->opening = opening, cloth->weave = weave, cloth->centre = centre;
    cloth->reach = 4.0 * wire, cloth->offset[0] = cloth->offset[1] = 0.0;
    return FILTRATION_OK;
}

/* Returns +1 where wire `own` lies above the plane at its crossing with wire `other`, otherwise -1. */
static inline double filtration__cloth_side(const filtration_cloth *cloth, int warp, int own, int other) {
    const int sum = own + other, over = cloth->weave == FILTRATION_TWILL_WEAVE ? (sum & 3) < 2 : (sum & 1) == 0;
    return over == warp ? 1.0 : -1.0;
}

/* Returns the height of a wire's axis above the plane at the position s along it, and its first two derivatives. */
static inline double filtration__cloth_axis(const filtration_cloth *cloth, int warp, int own, double s, double *first,
                                            double *second) {
    const double pitch = cloth->wire + cloth->opening, place = s / pitch - 0.5, crossing = floor(place),
                 amplitude = 0.5 * cloth->wire;
    const int other = (int)(crossing - 4.0 * floor(0.25 * crossing)); /* weaves repeat after four wires */
    const double here = filtration__cloth_side(cloth, warp, own, other);
    *first = *second = 0.0;
    if (filtration__cloth_side(cloth, warp, own, other + 1) == here) return here * amplitude;
    const double turn = RIDDLE_PI / pitch, angle = RIDDLE_PI * (place - crossing),
                 height = here * amplitude * riddle_cos(angle);
    *first = -here * amplitude * turn * riddle_sin(angle);
    *second = -height * turn * turn;
    return height;
}

/* Returns the square of the distance from a point to the axis of a wire at the position s along it, and half of its
   first and second derivatives by s. aside, along, z: the point relative to the wire's middle line. */
static inline double filtration__axis_distance(const filtration_cloth *cloth, int warp, int own, double aside,
                                               double along, double z, double s, double *slope, double *curve) {
    double first, second;
    const double away = z - filtration__cloth_axis(cloth, warp, own, s, &first, &second), way = s - along;
    *slope = way - away * first;
    *curve = 1.0 + first * first - away * second;
    return way * way + aside * aside + away * away;
}

/* Moves a position s along a wire's axis, whose squared distance is `least`, to the nearest one by Newton's method. */
static inline void filtration__nearest_place(const filtration_cloth *cloth, int warp, int own, double aside,
                                             double along, double z, double *s, double *least) {
    double slope, curve, ignored[2];
    for (int i = 0; i < 20; i++) {
        const double before = *least;
        filtration__axis_distance(cloth, warp, own, aside, along, z, *s, &slope, &curve);
        double move = curve > 0.1 ? -slope / curve : -slope;
        for (int half = 0; half < 8; half++, move *= 0.5) {
            const double square =
                filtration__axis_distance(cloth, warp, own, aside, along, z, *s + move, &ignored[0], &ignored[1]);
            if (!(square < *least)) continue;
            *least = square, *s += move;
            break;
        }
        if (!(*least < before * (1.0 - 1e-14))) break;
    }
}

/* Returns the distance from a point to the surface of a wire, negative inside: the nearest of several positions on its
   axis, refined. */
static inline double filtration__wire_distance(const filtration_cloth *cloth, int warp, int own, double aside,
                                               double along, double z) {
    double slope, curve, best = along;
    double least = filtration__axis_distance(cloth, warp, own, aside, along, z, along, &slope, &curve);
    const double reach = sqrt(least), step = (cloth->wire + cloth->opening) / 8.0;
    const int samples = (int)(reach / step) + 1;
    for (int i = -samples; i <= samples; i++) {
        const double at = along + reach * i / samples;
        const double square = filtration__axis_distance(cloth, warp, own, aside, along, z, at, &slope, &curve);
        if (square < least) least = square, best = at;
    }
    filtration__nearest_place(cloth, warp, own, aside, along, z, &best, &least);
    return sqrt(least) - 0.5 * cloth->wire;
}

/* Returns the distance to the nearest wire of one direction. across, along: position across and along the wires. A wire
   is no closer than its axis in the plan view. */
static inline double filtration__wires_distance(const filtration_cloth *cloth, int warp, double across, double along,
                                                double z, double nearest) {
    const double pitch = cloth->wire + cloth->opening, radius = 0.5 * cloth->wire;
    const int middle = (int)floor(across / pitch);
    const int reaching = (int)(cloth->reach / pitch) + 2;
    for (int k = 0; k <= 2 * reaching; k++) {
        const int i = middle + (k % 2 ? (k + 1) / 2 : -k / 2);
        const double aside = fabs(across - (i + 0.5) * pitch);
        if (aside - radius >= nearest) continue;
        const double distance = filtration__wire_distance(cloth, warp, i, aside, along, z);
        if (distance < nearest) nearest = distance;
    }
    return nearest;
}

FILTRATION_API double filtration_cloth_distance(const filtration_cloth *cloth, const double point[3]) {
    if (!cloth || !point) return (double)NAN;
    const double z = point[2] - cloth->centre, above = fabs(z) - cloth->wire, pitch = cloth->wire + cloth->opening;
    const double x = point[0] - cloth->offset[0], y = point[1] - cloth->offset[1];
    const double most = 1e9 * pitch;
    if (!(fabs(x) < most && fabs(y) < most && fabs(z) < 1e100 && pitch < 1e100) ||
        !(cloth->reach >= 0.0 && cloth->reach <= 4.0 * pitch))
        return (double)NAN; /* more wires than integers can count, or a cloth that filtration_cloth_make did not make */
    if (above > cloth->reach) return above;
    const double nearest = filtration__wires_distance(cloth, 1, x, y, z, cloth->reach);
    return filtration__wires_distance(cloth, 0, y, x, z, nearest);
}

static inline double filtration__cloth_at(const void *self, const double point[3]) {
    return filtration_cloth_distance((const filtration_cloth *)self, point);
}

/* Lists the places of a wire that are near a sphere: wherever its axis is locally nearest. A wire in a bend may touch a
   sphere twice. */
static inline int filtration__wire_touch(const filtration_cloth *cloth, int warp, int own, const double centre[3],
                                         double radius, double reach, int most, filtration_near *near) {
    const double along = centre[warp ? 1 : 0] - cloth->offset[warp ? 1 : 0];
    const double aside =
        centre[warp ? 0 : 1] - cloth->offset[warp ? 0 : 1] - (own + 0.5) * (cloth->wire + cloth->opening);
    const double z = centre[2] - cloth->centre, limit = radius + reach + 0.5 * cloth->wire,
                 span = limit * limit - aside * aside;
    double slope, curve, square[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    int found = 0;
    if (!(span > 0.0)) return 0;
    const double half = sqrt(span);
    const int samples = (int)(half / (cloth->wire + cloth->opening) * 8.0) + 4;
    for (int i = -samples; i <= samples + 1 && found < most; i++) {
        square[0] = square[1], square[1] = square[2];
        square[2] =
            filtration__axis_distance(cloth, warp, own, aside, along, z, along + half * i / samples, &slope, &curve);
        if (i == -samples || !(square[1] <= square[0] && square[1] < square[2])) continue;
        double s = along + half * (i - 1) / samples, least = square[1];
        filtration__nearest_place(cloth, warp, own, aside, along, z, &s, &least);
        const double distance = sqrt(least);
        if (!(distance < limit) || !(distance > 0.0)) continue;
        filtration_near *n = &near[found++];
        n->gap = distance - 0.5 * cloth->wire - radius;
        n->normal[warp ? 0 : 1] = -aside / distance, n->normal[warp ? 1 : 0] = (s - along) / distance;
        n->normal[2] = (filtration__cloth_axis(cloth, warp, own, s, &slope, &curve) - z) / distance;
    }
    return found;
}

static int filtration__cloth_touch(const void *self, const double centre[3], double radius, double reach, int most,
                                   filtration_near *near) {
    const filtration_cloth *cloth = (const filtration_cloth *)self;
    const double pitch = cloth->wire + cloth->opening, wide = radius + reach + 0.5 * cloth->wire;
    int found = 0;
    if (!(fabs(centre[2] - cloth->centre) < wide + 0.5 * cloth->wire)) return 0;
    for (int warp = 0; warp < 2; warp++) {
        const double across = centre[warp ? 0 : 1] - cloth->offset[warp ? 0 : 1];
        if (!(fabs(across) + wide < 1e9 * pitch)) return 0;
        const int first = (int)floor((across - wide) / pitch), last = (int)floor((across + wide) / pitch);
        for (int own = first; own <= last; own++)
            found += filtration__wire_touch(cloth, warp, own, centre, radius, reach, most - found, near + found);
    }
    return found;
}

FILTRATION_API filtration_solid filtration_cloth_solid(const filtration_cloth *cloth) {
    filtration_solid solid;
    solid.distance = filtration__cloth_at, solid.cut = NULL, solid.self = cloth, solid.touch = filtration__cloth_touch;
    return solid;
}

/* ---- beds ---- */

typedef struct filtration__bed_entry {
    ptrdiff_t index;
    int image[3]; /* in multiples of the box's edges */
} filtration__bed_entry;

/* Returns the distance from a point to the axis of a fibre, or to the centre of a sphere (b NULL), and the way there.
   */
static inline double filtration__axis_way(const double point[3], const double *a, const double *b, double way[3]) {
    double along = 0.0, length = 0.0, square = 0.0;
    for (int k = 0; k < 3 && b; k++)
        along += (point[k] - a[k]) * (b[k] - a[k]), length += (b[k] - a[k]) * (b[k] - a[k]);
    double share = length > 0.0 ? along / length : 0.0;
    if (share < 0.0) share = 0.0;
    if (share > 1.0) share = 1.0;
    for (int k = 0; k < 3; k++) {
        const double away = point[k] - a[k] - (b ? share * (b[k] - a[k]) : 0.0);
        way[k] = -away;
        square += away * away;
    }
    return sqrt(square);
}

/* Finds the range of cells near which object i, moved by an image, can be. Returns 0 if there are none. */
static inline int filtration__bed_range(const filtration_bed *bed, ptrdiff_t i, const int image[3], int from[3],
                                        int to[3]) {
    for (int k = 0; k < 3; k++) {
        const double a = bed->a[3 * i + k], b = bed->b ? bed->b[3 * i + k] : a, wide = bed->radius[i] + bed->reach;
        const double cell = bed->box[k] / bed->cells[k];
        const double low = (a < b ? a : b) - wide + image[k] * bed->box[k],
                     high = (a > b ? a : b) + wide + image[k] * bed->box[k];
        if (high < 0.0 || low > bed->box[k]) return 0;
        from[k] = low > 0.0 ? (int)(low / cell) : 0;
        to[k] = high < bed->box[k] ? (int)(high / cell) : bed->cells[k] - 1;
        if (from[k] > bed->cells[k] - 1) from[k] = bed->cells[k] - 1;
    }
    return 1;
}

/* Finds the images of object i that can be near the box. */
static inline void filtration__bed_images(const filtration_bed *bed, ptrdiff_t i, int low[3], int high[3]) {
    for (int k = 0; k < 3; k++) {
        const double a = bed->a[3 * i + k], b = bed->b ? bed->b[3 * i + k] : a, wide = bed->radius[i] + bed->reach;
        low[k] = high[k] = 0;
        if (!bed->periodic[k]) continue;
        low[k] = (int)floor(-((a > b ? a : b) + wide) / bed->box[k]);
        high[k] = (int)floor((bed->box[k] - (a < b ? a : b) + wide) / bed->box[k]) + 1;
    }
}

/* Counts the entries of each cell in start[cell + 1] (entry NULL), or stores them; start[cell] is then where the next
   one goes. */
static inline void filtration__bed_file(const filtration_bed *bed, size_t *start, filtration__bed_entry *entry) {
    int low[3], high[3], image[3], from[3], to[3];
    for (ptrdiff_t i = 0; i < bed->n; i++) {
        filtration__bed_images(bed, i, low, high);
        for (image[2] = low[2]; image[2] <= high[2]; image[2]++)
            for (image[1] = low[1]; image[1] <= high[1]; image[1]++)
                for (image[0] = low[0]; image[0] <= high[0]; image[0]++) {
                    if (!filtration__bed_range(bed, i, image, from, to)) continue;
                    for (int z = from[2]; z <= to[2]; z++)
                        for (int y = from[1]; y <= to[1]; y++)
                            for (int x = from[0]; x <= to[0]; x++) {
                                const size_t cell = (size_t)((z * bed->cells[1] + y) * bed->cells[0] + x);
                                if (!entry) {
                                    start[cell + 1]++;
                                    continue;
                                }
                                filtration__bed_entry *e = &entry[start[cell]++];
                                e->index = i;
                                memcpy(e->image, image, sizeof image);
                            }
                }
    }
}

static inline size_t filtration__bed_cells(const filtration_bed *bed) {
    return (size_t)bed->cells[0] * (size_t)bed->cells[1] * (size_t)bed->cells[2];
}

FILTRATION_API void filtration_bed_free(filtration_bed *bed) {
    if (!bed) return;
    if (bed->start)
        filtration__resize(&bed->memory, bed->start, (filtration__bed_cells(bed) + 1) * sizeof *bed->start, 0);
    if (bed->entry) filtration__resize(&bed->memory, bed->entry, bed->entries * sizeof *bed->entry, 0);
    memset(bed, 0, sizeof *bed);
}

static inline int filtration__bed_is_good(const filtration_bed *bed) {
    if (bed->n < 0 || (bed->n > 0 && (!bed->a || !bed->radius)) || !filtration__is_positive(bed->reach)) return 0;
    for (int k = 0; k < 3; k++)
        if (!filtration__is_positive(bed->box[k])) return 0;
    for (ptrdiff_t i = 0; i < bed->n; i++) {
        if (!filtration__is_positive(bed->radius[i])) return 0;
        for (int k = 0; k < 3; k++) { /* at most some thousand boxes away: images are counted in int */
            const double a = bed->a[3 * i + k], b = bed->b ? bed->b[3 * i + k] : a;
            if (!((fabs(a) + fabs(b) + bed->radius[i] + bed->reach) / bed->box[k] < 1e4)) return 0;
        }
    }
    return 1;
}

FILTRATION_API filtration_status filtration_bed_init(filtration_bed *bed, ptrdiff_t n, const double *a, const double *b,
                                                     const double *radius, const double box[3], const int periodic[3],
                                                     double reach, const filtration_memory *memory) {
    if (!bed) return FILTRATION_BAD_ARGUMENT;
    memset(bed, 0, sizeof *bed);
    if (!box || !periodic) return FILTRATION_BAD_ARGUMENT;
    bed->n = n, bed->a = a, bed->b = b, bed->radius = radius, bed->reach = reach;
    if (memory) bed->memory = *memory;
    memcpy(bed->box, box, sizeof bed->box), memcpy(bed->periodic, periodic, sizeof bed->periodic);
    if (!filtration__bed_is_good(bed)) {
        memset(bed, 0, sizeof *bed);
        return FILTRATION_BAD_ARGUMENT;
    }
    const double edge = riddle_cbrt(box[0]) * riddle_cbrt(box[1]) * riddle_cbrt(box[2]) / riddle_cbrt((double)n + 1.0);
    for (int k = 0; k < 3; k++)
        bed->cells[k] = box[k] / edge < 1.0 ? 1 : box[k] / edge < 64.0 ? (int)(box[k] / edge) : 64;
    const size_t cells = filtration__bed_cells(bed);
    bed->start = (size_t *)filtration__resize(&bed->memory, NULL, 0, (cells + 1) * sizeof *bed->start);
    if (!bed->start) {
        memset(bed, 0, sizeof *bed);
        return FILTRATION_NO_MEMORY;
    }
    memset(bed->start, 0, (cells + 1) * sizeof *bed->start);
    filtration__bed_file(bed, bed->start, NULL);
    for (size_t c = 0; c < cells; c++) bed->start[c + 1] += bed->start[c];
    bed->entries = bed->start[cells];
    if (bed->entries == 0) return FILTRATION_OK;
    bed->entry = (filtration__bed_entry *)filtration__resize(&bed->memory, NULL, 0, bed->entries * sizeof *bed->entry);
    if (!bed->entry) {
        filtration_bed_free(bed);
        return FILTRATION_NO_MEMORY;
    }
    filtration__bed_file(bed, bed->start, bed->entry);
    memmove(bed->start + 1, bed->start, cells * sizeof *bed->start); /* storing has moved each start to the next one */
    bed->start[0] = 0;
    return FILTRATION_OK;
}

/* Finds the cell of a point, which is wrapped into the box along periodic axes. */
static inline size_t filtration__bed_cell(const filtration_bed *bed, const double point[3], double inside[3]) {
    int cell[3];
    for (int k = 0; k < 3; k++) {
        inside[k] = bed->periodic[k] ? point[k] - bed->box[k] * floor(point[k] / bed->box[k]) : point[k];
        const double place = inside[k] / bed->box[k] * bed->cells[k];
        cell[k] = place >= 1.0 ? (place < bed->cells[k] ? (int)place : bed->cells[k] - 1) : 0;
    }
    return (size_t)((cell[2] * bed->cells[1] + cell[1]) * bed->cells[0] + cell[0]);
}

/* Returns the distance from a point (inside the box) to the surface of an object of a cell, and the way to its axis. */
static inline double filtration__bed_way(const filtration_bed *bed, const filtration__bed_entry *entry,
                                         const double inside[3], double way[3]) {
    double moved[3];
    for (int k = 0; k < 3; k++) moved[k] = inside[k] - entry->image[k] * bed->box[k];
    const double *b = bed->b ? bed->b + 3 * entry->index : NULL;
    return filtration__axis_way(moved, bed->a + 3 * entry->index, b, way) - bed->radius[entry->index];
}

FILTRATION_API double filtration_bed_distance(const filtration_bed *bed, const double point[3]) {
    if (!bed || !point) return (double)NAN;
    double inside[3], way[3], nearest = bed->reach;
    if (!bed->entry) return nearest;
    const size_t c = filtration__bed_cell(bed, point, inside);
    for (size_t e = bed->start[c]; e < bed->start[c + 1]; e++) {
        const double distance = filtration__bed_way(bed, &bed->entry[e], inside, way);
        if (distance < nearest) nearest = distance;
    }
    return nearest;
}

static int filtration__bed_touch(const void *self, const double centre[3], double radius, double reach, int most,
                                 filtration_near *near) {
    const filtration_bed *bed = (const filtration_bed *)self;
    double inside[3], way[3];
    int found = 0;
    if (!bed->entry) return 0;
    const size_t c = filtration__bed_cell(bed, centre, inside);
    for (size_t e = bed->start[c]; e < bed->start[c + 1] && found < most; e++) {
        const double distance = filtration__bed_way(bed, &bed->entry[e], inside, way),
                     axis = distance + bed->radius[bed->entry[e].index];
        if (!(distance - radius < reach) || !(axis > 0.0)) continue;
        near[found].gap = distance - radius;
        for (int k = 0; k < 3; k++) near[found].normal[k] = way[k] / axis;
        found++;
    }
    return found;
}

static inline double filtration__bed_at(const void *self, const double point[3]) {
    return filtration_bed_distance((const filtration_bed *)self, point);
}

FILTRATION_API filtration_solid filtration_bed_solid(const filtration_bed *bed) {
    filtration_solid solid;
    solid.distance = filtration__bed_at, solid.cut = NULL, solid.self = bed, solid.touch = filtration__bed_touch;
    return solid;
}

/* ---- images ---- */

FILTRATION_API filtration_status filtration_image_check(const filtration_image *m) {
    if (!m || !m->solid || !filtration__is_positive(m->edge) || m->reach < 1) return FILTRATION_BAD_ARGUMENT;
    for (int k = 0; k < 3; k++)
        if (m->n[k] < 1 || !filtration__is_finite(m->origin[k])) return FILTRATION_BAD_ARGUMENT;
    return FILTRATION_OK;
}

/* Returns whether cube c is solid; beyond a face that is not periodic it is not. */
static inline int filtration__cube_is_solid(const filtration_image *m, const int c[3]) {
    int at[3];
    for (int k = 0; k < 3; k++) {
        at[k] = c[k];
        if (m->periodic[k]) at[k] = (c[k] % m->n[k] + m->n[k]) % m->n[k];
        else if (c[k] < 0 || c[k] >= m->n[k]) return 0;
    }
    return m->solid[((size_t)at[2] * (size_t)m->n[1] + (size_t)at[1]) * (size_t)m->n[0] + (size_t)at[0]] != 0;
}

/* Returns the distance from the place p to cube c [cubes]; 0 inside. */
static inline double filtration__cube_distance(const double p[3], const int c[3]) {
    double square = 0.0;
    for (int k = 0; k < 3; k++) {
        const double away = p[k] < c[k] ? c[k] - p[k] : p[k] > c[k] + 1.0 ? p[k] - c[k] - 1.0 : 0.0;
        square += away * away;
    }
    return sqrt(square);
}

FILTRATION_API double filtration_image_distance(const filtration_image *m, const double point[3]) {
    if (!m || !point) return (double)NAN;
    double p[3];
    int home[3], c[3];
    for (int k = 0; k < 3; k++) {
        p[k] = (point[k] - m->origin[k]) / m->edge;
        home[k] = p[k] > -1e9 && p[k] < 1e9 ? (int)floor(p[k]) : 0;
    }
    const int own = filtration__cube_is_solid(m, home);
    double nearest = m->reach;
    for (int ring = 0; ring <= m->reach && ring - 1.0 < nearest;
         ring++) /* shells of cubes, until the next one is farther away than the
                                                                            nearest found */
        for (c[2] = home[2] - ring; c[2] <= home[2] + ring; c[2]++)
            for (c[1] = home[1] - ring; c[1] <= home[1] + ring; c[1]++) {
                const int on_shell = abs(c[2] - home[2]) == ring || abs(c[1] - home[1]) == ring;
                for (c[0] = home[0] - ring; c[0] <= home[0] + ring; c[0] += on_shell || ring == 0 ? 1 : 2 * ring) {
                    const double distance = filtration__cube_distance(p, c);
                    if (distance < nearest && filtration__cube_is_solid(m, c) != own) nearest = distance;
                }
            }
    return (own ? -nearest : nearest) * m->edge;
}

static inline double filtration__image_at(const void *self, const double point[3]) {
    return filtration_image_distance((const filtration_image *)self, point);
}

FILTRATION_API filtration_solid filtration_image_solid(const filtration_image *image) {
    filtration_solid solid;
    solid.distance = filtration__image_at, solid.cut = NULL, solid.self = image, solid.touch = NULL;
    return solid;
}
