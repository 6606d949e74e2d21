/* magnets.c - a contact law of one's own for Python (dem.Law): linear springs with friction, and an attraction while
   bodies touch. From the repository's root:

   cc -O3 -ffp-contract=off -fno-math-errno -fno-trapping-math -fPIC -shared -I. python/laws/magnets.c -lm
   -o magnets.so */
#include "dem.h"

static const double PULL = 2e-3; /* [N] */

DEM_INLINE void magnets_force(const dem_contact *c, double *state, dem_response *r) {
    dem_force_linear_friction(c, state, r);
    r->normal -= c->gap < 0.0 ? PULL : 0.0;
}

static const dem_law magnets = {"linear, magnets", 1,    3,   3, 1, DEM_LINEAR_CONSTANTS, dem_prepare_linear,
                                magnets_force,     NULL, NULL};
DEM_KERNEL(magnets_kernel, magnets, DEM_LINEAR | DEM_FRICTION)

size_t law_world_size(void);
dem_status law_run(dem_world *world, double duration);
size_t law_world_size(void) { return sizeof(dem_world); }
dem_status law_run(dem_world *world, double duration) { return dem_run_law(world, duration, &magnets_kernel); }
