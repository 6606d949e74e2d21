/* All kinds of walls. A new kind is a file like these and a row here; its name is in base/types.h. */
#pragma once
#include "cone.h"
#include "cylinder.h"
#include "disc.h"
#include "exit.h"
#include "mesh.h"
#include "plane.h"
#include "screen.h"
#include "sphere.h"

static const dem__wall_kind *const dem__wall_kinds[] = {
    &dem__plane, &dem__cylinder, &dem__woven_screen, &dem__exit, &dem__sphere, &dem__cone, &dem__triangles, &dem__disc,
};

/* Returns the row of a kind; NULL for an unknown kind. */
static inline const dem__wall_kind *dem__find_kind(int kind) {
    for (size_t k = 0; k < sizeof dem__wall_kinds / sizeof *dem__wall_kinds; k++) {
        if (dem__wall_kinds[k]->kind == kind) return dem__wall_kinds[k];
    }
    return NULL;
}
