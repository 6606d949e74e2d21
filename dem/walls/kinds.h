/* All kinds of walls. A new kind is a file like these and its row in the list; its name is in base/types.h. */
#pragma once
#include "cone.h"
#include "cylinder.h"
#include "disc.h"
#include "exit.h"
#include "mesh.h"
#include "plane.h"
#include "screen.h"
#include "sphere.h"

/* Returns the row of a kind; NULL for an unknown kind. */
static inline const dem__wall_kind *dem__find_kind(int kind) {
    const dem__wall_kind *const row[] = {
        dem__plane(),  dem__cylinder(), dem__woven_screen(), dem__exit(),
        dem__sphere(), dem__cone(),     dem__triangles(),    dem__disc(),
    };
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
        if (row[k]->kind == kind) return row[k];
    }
    return NULL;
}
