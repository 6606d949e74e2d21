/* filtration.h: cake filtration: the filtration equation, filter curves, prediction; a fluid resolved around spheres
   and solids.

   #include <stdio.h>
   #include "filtration.h"
   int main(void) {
       const double time[] = {22, 51, 89, 134, 187, 249, 318};                         // [s]
       const double volume[] = {2e-4, 4e-4, 6e-4, 8e-4, 1e-3, 1.2e-3, 1.4e-3};          // of filtrate [m3]
       filtration_curve_def def = filtration_curve_default_def();                       // SI; 1 bar, water, 20 cm2
       filtration_curve curve;
       if (filtration_evaluate(&def, 7, time, volume, &curve)) return 1;
       printf("r_K K_S %.3g 1/m2 (%.3g .. %.3g), R_M %.3g 1/m\n", curve.product.value, curve.product.low,
              curve.product.high, curve.medium.value);
       return 0;
   }

   Models. Filtration equation (1) to (3): Puderbach, Schmidt and Antonyuk (2021), "the paper"; evaluation in the manner
   of VDI 2762; Kozeny and Carman (1937); compressible cakes: power laws, Tiller (1953). Fluid: lattice Boltzmann, D3Q19
   or D3Q15, in place (Bailey et al. 2009), two relaxation times and a third for the trace of the stress (Ginzburg et
   al. 2008); surfaces: central linear interpolation; force on spheres: momentum exchange, Galilean invariant (Wen et
   al. 2014).

   Find your way: >>base, >>process, >>solids, >>fluid (filtration_fluid_init, _step, _at); >>lattice, >>collide,
   >>faces, >>links, >>spheres, >>flow are its bodies. It is developed in parts: filtration/.

   Units: SI. Fractions and numbers without unit [-].

   Memory, threads: filtration_bed_init and filtration_fluid_init allocate, through a hook, and a step when spheres are
   added: 160 bytes a node (80 in floats). No object is shared; a fluid's step runs def.threads threads. Functions of
   yours that are called (threads, a solid's distance, a flow, streams) may read the fluid, and change nothing of it.

   Determinism: same input, same bits on every machine and compiler, for any number of threads (without fused
   multiply-add: -ffp-contract=off).

   What it does not do: washing, dewatering, free surfaces. Spheres are moved by the caller or its particle code.

   Shared copy instead of static inline: #define FILTRATION_API extern everywhere and FILTRATION_IMPLEMENTATION
   in one file. */
#ifndef RIDDLE_FILTRATION_H
#define RIDDLE_FILTRATION_H

#include "base/compiler.h"

/* clang fuses products and sums only if it may. */
#if defined(__clang__)
#pragma float_control(push)
#pragma clang fp contract(off)
#elif defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__) && !defined(__SANITIZE_ADDRESS__)
#pragma GCC push_options
#pragma GCC optimize("O3", "no-math-errno", "no-trapping-math", "fp-contract=off")
#endif
#ifdef __cplusplus
extern "C" {
#endif

/* Declarations, and pure laws. */
#include "process/process_api.h"
#include "fluid/api.h"
#include "process/process_laws.h"
#include "process/settling_laws.h"

/* Bodies: the parts that no other one includes. */
#ifdef FILTRATION__BODIES
#include "process/compressibility.h"
#include "fluid/save.h"
#include "motion/motion.h"
#include "fluid/permeability.h"
#endif

#ifdef __cplusplus
}
#endif
#if defined(__clang__)
#pragma float_control(pop)
#elif defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__) && !defined(__SANITIZE_ADDRESS__)
#pragma GCC pop_options
#endif
#endif /* RIDDLE_FILTRATION_H */
