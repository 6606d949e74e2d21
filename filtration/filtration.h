/* filtration.h: cake filtration: the filtration equation, the evaluation of filter curves, prediction; solids.

   #include <stdio.h>
   #include "filtration.h"
   int main(void) {
       const double time[] = {22, 51, 89, 134, 187, 249, 318};                         // [s]
       const double volume[] = {2e-4, 4e-4, 6e-4, 8e-4, 1e-3, 1.2e-3, 1.4e-3};          // of filtrate [m3]
       filtration_curve_def def = filtration_curve_default_def();                       // SI; 1 bar, water, 20 cm2
       filtration_curve curve;
       if (filtration_evaluate(&def, 7, time, volume, &curve)) return 1;
       printf("r_K K_S %.3g 1/m2 (%.3g .. %.3g), R_M %.3g 1/m\n", curve.product.value, curve.product.low, curve.product.high,
              curve.medium.value);
       return 0;
   }

   Models. Filtration equation (1) to (3): Puderbach, Schmidt and Antonyuk (2021), "the paper"; evaluation in the manner of VDI 2762;
   Kozeny and Carman (1937); compressible cakes: power laws, Tiller (1953).

   Find your way: >>base, >>process, >>solids; the bodies have the same tags. It is developed in parts: filtration/.

   Units: SI. Fractions and numbers without unit [-].

   Memory, threads: only filtration_bed_init allocates, through its hook. No object is shared.

   Determinism: same input, same bits on every machine and compiler (without fused multiply-add: -ffp-contract=off).

   What it does not do: settling of the suspension on the way, washing, dewatering.

   Shared copy instead of static inline: #define FILTRATION_API extern everywhere and FILTRATION_IMPLEMENTATION in one file. */
#ifndef RIDDLE_FILTRATION_H
#define RIDDLE_FILTRATION_H

#include "compiler.h"
#include "base.h"
#include "process_api.h"
#include "solids_api.h"
#include "../tests/portable_math.h"
#include "process_laws.h"
#include "settling_laws.h"
#ifdef FILTRATION__BODIES
#include "process.h"
#include "evaluate.h"
#include "solids.h"
#endif

#ifdef __cplusplus
}
#endif
#if defined(__clang__)
#pragma float_control(pop)
#elif defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__)
#pragma GCC pop_options
#endif
#endif /* RIDDLE_FILTRATION_H */
