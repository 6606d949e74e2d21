/* dem.h - particles in time: contact laws, walls and screens, neighbour search, integration.

       #include <stdio.h>

       #include "dem.h"

       int main(void) {
           dem_def def = dem_default_def();                      // SI units, every field documented below
           int glass = dem_add_material(&def, 2534.1, 50e9, 0.2);
           dem_pair(&def, glass, glass)->restitution = 0.78;
           def.dt = 4e-6;
           dem_world world;
           dem_status status = dem_init(&world, &def, NULL);     // names the first bad field
           double centre[3] = {0.0, 0.0, 0.1}, diameter = 0.005;
           dem_add_plane(&world, glass, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
           dem_add_spheres(&world, 1, centre, &diameter, glass, 0);
           if (status == DEM_OK) status = dem_run(&world, 0.5, DEM_LINEAR | DEM_FRICTION);
           printf("%s, height %g m\n", dem_status_text(status), dem_position(&world, 0).z);
           dem_free(&world);
           return status != DEM_OK;
       }

   Models    linear spring-dashpot, naive or clipped restitution (Schwager & Poeschel 2007); Hertz-Mindlin with damping
             from the coefficient of restitution (Tsuji et al. 1992); tangential spring with Coulomb limit (Cundall &
             Strack 1979); rolling resistance with a lever arm in metres, relative and capped. A law of your own:
             dem_law and DEM_KERNEL below.
   Bodies    spheres, clumps of them (dem_add_clumps, docs/dem_bodies.md), convex polyhedra with rounded edges
             (dem_add_convex, docs/dem_convex.md), and bodies of several of these (dem_add_compounds).
   Walls     plane, cylinder, wire screen, cone, disc, sphere, box, triangle mesh (STL); each at rest, vibrating,
             turning, moving, prescribed or driven by a force or torque. A wall supplies geometry (normal, gap, surface
             velocity, inverse mass 0); everything after that is the pair's kernel.
   Time      A particle is on a parabola from the step at which its last force ended; only particles that touch
             something take steps. Velocity Verlet with the dashpot's velocity predicted and the first and last step of
             a contact resolved in time: second order in dt with damping, third for the restitution of a linear contact.
             A pair is not tested before it can touch. Results do not depend on what is skipped, bit for bit.
   Filling   by size distribution without overlap, at once (dem_fill) or in time (dem_feed_mass); removing by region.
   Measuring regions, stress, coarse-grained fields (Goldhirsch 2010), histograms, residence, mixing: readers of a
             const world.
   Memory    The world owns all; one allocator hook; nothing is allocated in a step unless a capacity grows. 560 bytes a
             sphere and 12 more for every wall, 40 a near pair, 340 a contact with friction (64 more with a ledger),
             room for at least 64 to 1024 of each and 6 near pairs a sphere, and half as much again for growing. Running
             out gives DEM_OUT_OF_MEMORY and a world that can be read, saved and freed.
   Threads   def.threads with OpenMP (no more than there are processors) or a pool of the host's, else one; fewer where
             a loop has little work or another program takes the cores. Same bits for any number. Worlds are independent
             of each other; several threads may read one.
   Bits      The same on every machine that computes IEEE doubles, if compiled with -ffp-contract=off;
             dem_build_is_deterministic().
   Flags     -O2 is enough: with gcc the functions here bring their own options (#pragma GCC optimize, undone at the
             end), and with gcc and clang sqrt in a file that includes this does not set errno. A law of yours takes
             part if declared DEM_INLINE.
   Linking   one shared copy: #define DEM_API extern everywhere, DEM_IMPLEMENTATION as well in one file; laws of yours
             stand there.
   Fields    a force on every particle, in flight by steps of its own, by a law of yours (DEM_FORCE_FIELD); drag in a
             gas, at rest or on a Cartesian grid that turns with a wall (DEM_GAS): Stokes, Schiller & Naumann, Hoelzer &
             Sommerfeld; with a porosity Di Felice, Gidaspow, Beetstra, Koch & Hill.
   Not here  the flow of fluids, heat, files, printing. */
#ifndef DEM_H
#define DEM_H

#include "base/compiler.h"

/* gcc, from -O1 on, but not at -Os: loops vectorise and no product is fused with a sum, whatever else a host is built
   with. Clang fuses only if told to by -ffp-contract=fast. With the address sanitizer the command line decides. */
#if defined(__clang__)
#pragma float_control(push)
#pragma clang fp contract(off)
#elif defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__) && !defined(__SANITIZE_ADDRESS__)
#pragma GCC push_options
#pragma GCC optimize("O2", "no-math-errno", "no-trapping-math", "fp-contract=off")
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Declarations, and the pure functions that laws of a user call. */
#include "base/api.h"
#include "base/measure_api.h"
#include "base/polyhedron.h"
#include "base/triangles.h"
#include "contacts/laws.h"
#include "gas/laws.h"

/* Bodies: the parts that no other one includes. */
#ifdef DEM__BODIES
#include "motion/change.h"
#include "step/step.h"
#include "links/links.h"
#include "gas/flights.h"
#include "bodies/clump_shape.h"
#include "polyhedra/clump_of_mesh.h"
#include "gas/gas.h"
#include "removal/remove.h"
#include "measure/mixing.h"
#include "measure/orientation.h"
#include "save/save.h"
#include "save/load.h"
#include "contacts/time_step.h"
#include "polyhedra/compound.h"
#endif

#ifdef __cplusplus
}
#endif
#if defined(__clang__)
#pragma float_control(pop)
#elif defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__) && !defined(__SANITIZE_ADDRESS__)
#pragma GCC pop_options
#endif
#endif /* DEM_H */
