/* Clumps in a world: adds rigid bodies of spheres. Reads shapes; writes a world through dem__add_body. */
#pragma once
#include "add.h"

/* Returns whether these are moments of a body: no moment exceeds the sum of the two others. */
static inline int dem__are_moments(dem_vec m) {
    if (!dem__positive(m.x) || !dem__positive(m.y) || !dem__positive(m.z)) return 0;
    const double most = (1.0 + 1e-6) * (m.x + m.y + m.z);
    return 2.0 * m.x <= most && 2.0 * m.y <= most && 2.0 * m.z <= most;
}

static inline int dem__is_clump(const dem_clump *c) {
    dem_quaternion unit;
    if (!c || c->spheres < 1 || c->spheres > DEM_CLUMP_MAX || !dem__positive(c->volume) ||
        !dem__unit_turn(c->axes, &unit))
        return 0;
    if (!dem__are_moments(c->moments)) return 0;
    for (int k = 0; k < c->spheres; k++) {
        if (!dem__positive(c->radius[k]) || !dem__finite_vec(c->centre[k])) return 0;
    }
    return 1;
}

/* Returns whether a compound has shapes of a world, and valid numbers. */
static inline int dem__is_compound(const dem_world *w, const dem_compound *c) {
    dem_quaternion unit;
    if (!c || c->parts < 1 || c->parts > DEM_PARTS_MAX || !dem__positive(c->volume) || !dem__are_moments(c->moments) ||
        !dem__unit_turn(c->axes, &unit))
        return 0;
    for (int k = 0; k < c->parts; k++) {
        if (c->shape[k] < 0 || c->shape[k] >= w->engine->convex.shapes || !dem__finite_vec(c->centre[k]) ||
            !dem__unit_turn(c->turn[k], &unit))
            return 0;
    }
    return 1;
}

/* Returns the radius of the sphere about the centre of mass that contains a compound [m]. */
static inline double dem__compound_reach(const dem_world *w, const dem_compound *c) {
    double reach = 0.0;
    for (int k = 0; k < c->parts; k++) {
        const double r = dem__length(c->centre[k]) + w->engine->convex.shape[c->shape[k]].reach;
        reach = r > reach ? r : reach;
    }
    return reach;
}

DEM_API double dem_clump_diameter(const dem_clump *clump) {
    return clump && dem__positive(clump->volume) ? riddle_cbrt(6.0 / RIDDLE_PI * clump->volume) : (double)NAN;
}

/* Returns the radius of the sphere about the centre of mass that contains a clump [m]. */
static inline double dem__clump_reach(const dem_clump *c) {
    double reach = 0.0;
    for (int k = 0; k < c->spheres; k++) {
        const double r = dem__length(c->centre[k]) + c->radius[k];
        reach = r > reach ? r : reach;
    }
    return reach;
}

/* Returns the definition of a body with a clump's shape, `scale` times as large, made of a material. offset and radius:
   [spheres], filled here. */
static inline dem__body_def dem__clump_body(const dem_world *w, const dem_clump *c, double scale, int material,
                                            dem_vec *offset, double *radius) {
    const double density = w->def.material[material].density, cube = scale * scale * scale;
    dem__body_def def;
    dem_quaternion axes = dem__quaternion(1.0, dem_vec3(0.0, 0.0, 0.0));
    memset(&def, 0, sizeof def);
    dem__unit_turn(c->axes, &axes);
    for (int k = 0; k < c->spheres; k++)
        offset[k] = dem__scale(scale, dem__to_body(axes, c->centre[k])), radius[k] = scale * c->radius[k];
    def.mass = density * cube * c->volume;
    def.moments = dem__scale(density * cube * scale * scale, c->moments);
    def.frame = axes, def.turn = dem__quaternion(1.0, dem_vec3(0.0, 0.0, 0.0));
    def.pieces = c->spheres, def.offset = offset, def.radius = radius, def.material = material;
    return def;
}

/* Returns whether a body's mass and moments, and their inverses, are valid numbers. */
static inline int dem__is_body_def(const dem__body_def *def) {
    const dem_vec m = def->moments;
    if (!dem__positive(def->mass) || !dem__positive(m.x) || !dem__positive(m.y) || !dem__positive(m.z)) return 0;
    if (!dem__positive(1.0 / m.x) || !dem__positive(1.0 / m.y) || !dem__positive(1.0 / m.z)) return 0;
    for (ptrdiff_t k = 0; k < def->pieces; k++) {
        const double r = def->radius[k];
        if (!dem__positive(def->mass * r * r) || !dem__positive(1.0 / (def->mass * r * r))) return 0;
    }
    return 1;
}

DEM_API dem_status dem_add_clumps(dem_world *world, ptrdiff_t n, const dem_clump *clump, const double *centres,
                                  const double *diameters, const double *orientations, int material, int group) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    dem_vec offset[DEM_CLUMP_MAX];
    double radius[DEM_CLUMP_MAX];
    if (dem__lacks_material(w, material)) return DEM_BAD_ARGUMENT;
    if (n < 0) return dem__refuse(w, "n: below 0");
    if (n > 0 && !centres) return dem__refuse(w, "centres: NULL");
    if (!dem__is_clump(clump)) return dem__refuse(w, "clump: NULL, or not one that dem_make_clump made");
    if (n > (INT32_MAX / 4 - w->count) / clump->spheres) return DEM_TOO_MANY;
    const double own = dem_clump_diameter(clump);
    for (ptrdiff_t k = 0; k < n; k++) {
        dem_quaternion q = dem__quaternion(1.0, dem_vec3(0.0, 0.0, 0.0));
        const double *o = orientations ? orientations + 4 * k : NULL;
        if (diameters && !dem__positive(diameters[k]))
            return dem__refuse(w, "diameters: one is not a finite number above 0");
        const dem__body_def def =
            dem__clump_body(w, clump, diameters ? diameters[k] / own : 1.0, material, offset, radius);
        if (!dem__is_body_def(&def))
            return dem__refuse(w, "diameters: mass or inertia of a body is not a normal number");
        if (!dem__finite_vec(dem_vec3(centres[3 * k], centres[3 * k + 1], centres[3 * k + 2])))
            return dem__refuse(w, "centres: a coordinate is not finite");
        if (o && !dem__unit_turn(dem__quaternion(o[0], dem_vec3(o[1], o[2], o[3])), &q))
            return dem__refuse(w, "orientations: a quaternion is 0 or not finite");
    }
    if (n == 0) return DEM_OK;
    if (!dem__reserve_bodies(w, n, n * clump->spheres)) return DEM_OUT_OF_MEMORY;
    for (ptrdiff_t k = 0; k < n; k++) {
        const double *o = orientations ? orientations + 4 * k : NULL;
        dem__body_def def = dem__clump_body(w, clump, diameters ? diameters[k] / own : 1.0, material, offset, radius);
        def.x = dem_vec3(centres[3 * k], centres[3 * k + 1], centres[3 * k + 2]), def.group = group;
        if (o) dem__unit_turn(dem__quaternion(o[0], dem_vec3(o[1], o[2], o[3])), &def.turn);
        dem__add_body(w, &def);
    }
    return DEM_OK;
}
