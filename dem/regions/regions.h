/* Regions: their volumes, and whether a point is in one. */
#pragma once
#include "../walls/solid.h"

DEM_API dem_region dem_box_region(dem_vec low, dem_vec high) {
    dem_region region;
    memset(&region, 0, sizeof region);
    region.kind = DEM_REGION_BOX;
    region.low = low;
    region.high = high;
    return region;
}
DEM_API dem_region dem_cylinder_region(dem_vec bottom, dem_vec axis, double length, double radius) {
    dem_region region;
    memset(&region, 0, sizeof region);
    region.kind = DEM_REGION_CYLINDER;
    region.low = bottom;
    region.axis = axis;
    region.length = length;
    region.radius = radius;
    return region;
}
DEM_API dem_region dem_sphere_region(dem_vec centre, double radius) {
    dem_region region;
    memset(&region, 0, sizeof region);
    region.kind = DEM_REGION_SPHERE;
    region.low = centre;
    region.radius = radius;
    return region;
}

/* Returns whether a length of a region is 0, or in a range in which its volume is a normal number. */
static inline int dem__is_extent(double v) { return v == 0.0 || (v >= 1e-100 && v <= 1e100); }

static inline int dem__is_region(const dem_region *r) {
    dem_vec unit;
    if (!r || !dem__finite_vec(r->low)) return 0;
    if (r->kind == DEM_REGION_MESH) return r->mesh != NULL;
    if (r->kind == DEM_REGION_BOX)
        return dem__finite_vec(r->high) && dem__is_extent(r->high.x - r->low.x) &&
               dem__is_extent(r->high.y - r->low.y) && dem__is_extent(r->high.z - r->low.z);
    if (!dem__is_extent(r->radius)) return 0;
    if (r->kind == DEM_REGION_SPHERE) return 1;
    return r->kind == DEM_REGION_CYLINDER && dem__finite_vec(r->axis) && dem__unit(r->axis, &unit) &&
           dem__is_extent(r->length);
}

DEM_API double dem_region_volume(const dem_region *region) {
    if (!dem__is_region(region)) return (double)NAN;
    const dem_region *r = region;
    if (r->kind == DEM_REGION_MESH) return dem__mesh_volume(r->mesh);
    if (r->kind == DEM_REGION_BOX) return (r->high.x - r->low.x) * (r->high.y - r->low.y) * (r->high.z - r->low.z);
    return RIDDLE_PI * r->radius * r->radius * (r->kind == DEM_REGION_SPHERE ? 4.0 / 3.0 * r->radius : r->length);
}

DEM_API int dem_region_holds(const dem_region *region, dem_vec point) {
    const dem_region *r = region;
    dem_vec unit = dem_vec3(0.0, 0.0, 0.0);
    if (!dem__is_region(r)) return 0;
    const dem_vec d = dem__sub(point, r->low);
    const int in_box = point.x >= r->low.x && point.x <= r->high.x && point.y >= r->low.y && point.y <= r->high.y &&
                       point.z >= r->low.z && point.z <= r->high.z;
    if (r->kind == DEM_REGION_BOX) return in_box;
    if (r->kind == DEM_REGION_MESH) return in_box && dem__is_inside_mesh(r->mesh, point);
    if (r->kind == DEM_REGION_SPHERE) return dem__dot(d, d) <= r->radius * r->radius;
    dem__unit(r->axis, &unit);
    const double along = dem__dot(d, unit);
    return along >= 0.0 && along <= r->length && dem__dot(d, d) - along * along <= r->radius * r->radius;
}

/* Finds a box around a region. */
static inline void dem__tree_bounds(const dem_region *r, dem_vec *low, dem_vec *high) {
    dem_vec unit = dem_vec3(0.0, 0.0, 0.0);
    if (r->kind == DEM_REGION_CYLINDER) dem__unit(r->axis, &unit);
    const int has_box = r->kind == DEM_REGION_BOX || r->kind == DEM_REGION_MESH;
    for (int a = 0; a < 3; a++) {
        const double at = dem_axis(r->low, a),
                     end = has_box ? dem_axis(r->high, a) : at + r->length * dem_axis(unit, a);
        const double out = has_box ? 0.0 : r->radius;
        *dem_axis_of(low, a) = (at < end ? at : end) - out;
        *dem_axis_of(high, a) = (at > end ? at : end) + out;
    }
}
