/* Spheres as walls: hollow, with particles inside, or solid ones with particles outside. */
#pragma once
#include "round.h"

static inline int dem__touch_sphere(const dem_wall *w, dem_vec d, double radius, double limit, dem__touch *out,
                                    double *least) {
    return dem__touch_round(w, d, 1.0, radius, limit, out, least);
}

static inline double dem__reach_sphere(const dem_wall *w, dem_vec d, int32_t element, dem_vec *from, double *inner) {
    (void)element;
    return dem__side_of_round(w, d, from, inner);
}

static inline dem_vec dem__turn_at_sphere(const dem_wall *w, dem_vec d, double radius, int32_t element, dem_vec n,
                                          double inverse, dem_vec u) {
    (void)w, (void)d, (void)radius, (void)element;
    return dem__scale(inverse, dem__sub(u, dem__scale(dem__dot(u, n), n)));
}

/* A solid sphere touches a polyhedron like a corner of a wall, with all of its surface. */
static inline int dem__sphere_corners(const dem_wall *w) { return w->inside ? DEM__CORNERS_ALL : DEM__CORNERS_NONE; }
static inline void dem__sphere_edges(const dem_wall *w, dem_vec centre, double reach, dem__edge_visitor *v) {
    (void)reach;
    if (!w->inside) v->corner(v, dem__sub(w->position, centre), w->radius, dem_vec3(0.0, 0.0, 0.0), 0);
}

static inline const dem__wall_kind *dem__sphere(void) {
    static const dem__wall_kind row = {
        DEM_SPHERE,          /* kind */
        0,                   /* flags */
        dem__is_round,       /* is_sound */
        dem__touch_sphere,   /* touch */
        NULL,                /* touch_element */
        NULL,                /* other_elements */
        dem__reach_sphere,   /* reach_round */
        dem__turn_at_sphere, /* normal_rate */
        NULL,                /* is_endless */
        NULL,                /* closing */
        dem__sphere_corners, /* corners */
        dem__sphere_edges,   /* edges */
        NULL                 /* crosses */
    };
    return &row;
}

DEM_API int dem_add_sphere_wall(dem_world *world, int material, dem_vec centre, double radius, int inside) {
    return dem__add_round(world, dem__sphere(), material, centre, dem_vec3(0, 0, 1), radius, inside);
}
