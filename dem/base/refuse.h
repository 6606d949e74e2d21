/* Refusing a call: its status, and the argument and the reason that dem_error_text() tells. */
#pragma once
#include "engine.h"

/* Stores which argument is wrong and why: a string that lives as long as the program. */
static inline dem_status dem__refuse(dem_world *w, const char *text) {
    if (w) w->refusal = text;
    return DEM_BAD_ARGUMENT;
}

/* Each of these returns whether the world lacks something that an argument names, and then stores the text. */
static inline int dem__lacks_memory(dem_world *w) {
    return !(w && w->def.allocator.fn) && dem__refuse(w, "world: dem_init or dem_load has not made it");
}
static inline int dem__lacks_material(dem_world *w, int material) {
    return dem__lacks_memory(w) || ((material < 0 || material >= w->def.materials) &&
                                    dem__refuse(w, "material: the world has no material of this index"));
}
static inline int dem__lacks_wall(dem_world *w, int wall) {
    return !w || ((wall < 0 || wall >= w->walls) && dem__refuse(w, "wall: the world has no wall of this index"));
}
static inline int dem__lacks_particle(dem_world *w, ptrdiff_t i) {
    return !w ||
           ((i < 0 || i >= w->count || !w->alive[i]) && dem__refuse(w, "i: no particle of this index is present"));
}
