/* Exits: planes without a surface. A particle leaves when its centre is beyond one. */
#pragma once
#include "plane.h"

static inline int dem__touch_exit(const dem_wall *w, dem_vec d, double radius, double limit, dem__touch *out,
                                  double *least) {
    (void)radius;
    return dem__touch_plane(w, d, 0.0, limit, out, least);
}

static inline const dem__wall_kind *dem__exit(void) {
    static const dem__wall_kind row = {
        DEM_EXIT,                      /* kind */
        DEM__NO_SURFACE | DEM__CONVEX, /* flags */
        NULL,                          /* is_sound */
        dem__touch_exit,               /* touch */
        NULL,                          /* touch_element */
        NULL,                          /* other_elements */
        NULL,                          /* reach_round */
        NULL,                          /* normal_rate */
        dem__is_along_plane,           /* is_endless */
        NULL,                          /* closing */
        NULL,                          /* corners */
        NULL,                          /* edges */
        NULL                           /* crosses */
    };
    return &row;
}

DEM_API int dem_add_exit(dem_world *world, dem_vec point, dem_vec normal) {
    return dem__add_flat(world, dem__exit(), 0, point, normal);
}
