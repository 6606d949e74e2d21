/* Reading links. */
#pragma once
#include "../measure/getters.h"
#include "list.h"

DEM_API ptrdiff_t dem_link_count(const dem_world *world) {
    return world && world->engine ? world->engine->links.count : 0;
}

DEM_API dem_contact_info dem_get_link(const dem_world *world, ptrdiff_t k) {
    dem_contact_info info;
    memset(&info, 0, sizeof info);
    info.gap = (double)NAN;
    if (!world || !world->engine || k < 0 || k >= world->engine->links.count) return info;
    info.i = world->engine->links.i[k];
    info.j = world->engine->links.j[k];
    info.element = world->engine->links.element[k];
    info.gap = world->engine->links.gap[k];
    info.force = dem_vec3(world->engine->links.wrench[0][k], world->engine->links.wrench[1][k],
                          world->engine->links.wrench[2][k]);
    for (int a = 0; a < world->engine->links.states; a++) info.state[a] = world->engine->links.state[a][k];
    dem__find_point(world, -1, &info);
    return info;
}

DEM_API ptrdiff_t dem_find_link(const dem_world *world, ptrdiff_t i, ptrdiff_t j, int32_t element) {
    return dem_link_count(world) > 0 && i >= 0 && i < world->count ? dem__link_of(world, i, j, element) : -1;
}
