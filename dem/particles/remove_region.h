/* Taking out the records of what passed exits, and the particles in a region. Owns nothing; relies on regions and on
   the removal of a particle. */
#pragma once
#include "remove.h"
#include "../measure/getters.h"
#include "../feed/sizes.h"

DEM_API ptrdiff_t dem_take_passed(dem_world *world, dem_passed *records, ptrdiff_t capacity) {
    dem_world *w = world;
    if (dem__is_running(w)) return -(ptrdiff_t)DEM_BUSY;
    if (!w || !w->def.allocator.fn || capacity < 0) return -(ptrdiff_t)DEM_BAD_ARGUMENT;
    const ptrdiff_t n = capacity < w->passed_count ? capacity : w->passed_count, left = w->passed_count - n;
    if (n == 0) return 0;
    if (records) memcpy(records, w->passed, (size_t)n * sizeof *records);
    memmove(w->passed, w->passed + n, (size_t)left * sizeof *records);
    w->passed_count = left;
    return n;
}

DEM_API ptrdiff_t dem_remove_region(dem_world *world, const dem_region *region) {
    if (dem__is_running(world)) return -(ptrdiff_t)DEM_BUSY;
    dem_world *w = world;
    ptrdiff_t removed = 0;
    if (!w || !w->def.allocator.fn || !dem__is_region(region)) return -(ptrdiff_t)DEM_BAD_ARGUMENT;
    w->engine->run.running = 1;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const dem__rigid *r = dem__rigid_of(w, i);
        if (r && r->first != i) continue;
        if (!w->alive[i] || !dem_region_holds(region, r ? dem__body_position(w, r) : dem_position(w, i))) continue;
        dem__detach_particle(w, i);
        removed++;
    }
    if (removed > 0) dem__end_contacts_of_removed(w);
    w->engine->run.running = 0;
    return removed;
}
