/* What depends on the compiler: inlining, options, prefetch, AVX2 copies of loops. */
#pragma once

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#ifdef _OPENMP
#include <omp.h>
#endif

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "dem.h needs NaN and exact arithmetic: compile without -ffast-math and -ffinite-math-only"
#endif

#ifndef DEM_API
#define DEM_API static inline
#define DEM__BODIES
#elif defined(DEM_IMPLEMENTATION)
#define DEM__BODIES
#endif

/* gcc, from -O1 on, but not at -Os: loops vectorise and no product is fused with a sum, whatever the options of the
   host. Clang fuses only if told to by -ffp-contract=fast. Without these options gcc does not vectorise most loops at
   -O2, or a loop with a root that may set errno or with arithmetic that may trap. The loops of a step (DEM__FAST) are
   compiled as with -O3, the rest as with -O2: that saves a quarter of the compile time and costs no speed. With the
   address sanitizer the command line decides. */
#if defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__NO_MATH_ERRNO__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wredundant-decls"
#ifdef __cplusplus
extern "C" double sqrt(double) noexcept(noexcept(::sqrt(1.0))) __attribute__((const));
#else
extern double sqrt(double) __attribute__((const));
#endif
#pragma GCC diagnostic pop
#endif
#if defined(__clang__)
#define DEM__FAST
#elif defined(__GNUC__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__) && !defined(__SANITIZE_ADDRESS__)
#define DEM__FAST __attribute__((optimize("O3", "no-math-errno", "no-trapping-math", "fp-contract=off")))
#else
#define DEM__FAST
#endif

/* Functions that are never inlined (DEM__NOINLINE), or for which the compiler decides (DEM__STATIC). Without
   optimisation both are declared inline, because gcc then emits every other static function, whether or not anything
   calls it. */
#if !defined(__GNUC__)
#define DEM__NOINLINE
#define DEM__STATIC static
#elif defined(__OPTIMIZE__)
#define DEM__NOINLINE __attribute__((noinline))
#define DEM__STATIC static
#else
#define DEM__NOINLINE inline
#define DEM__STATIC static inline
#endif
#if defined(__GNUC__)
#define DEM_INLINE static inline __attribute__((always_inline)) DEM__FAST
#define DEM_RESTRICT __restrict__
#elif defined(_MSC_VER)
#define DEM_INLINE static __forceinline
#define DEM_RESTRICT __restrict
#else
#define DEM_INLINE static inline
#define DEM_RESTRICT
#endif

/* dem_run is compiled where it is called: constant features then leave only the kernel that they choose. */
#if defined(__GNUC__) && !defined(DEM_IMPLEMENTATION)
#define DEM__CHOICE static inline __attribute__((always_inline))
#else
#define DEM__CHOICE DEM_API
#endif

/* Particles are scattered in memory. Those needed soon are prefetched into the second cache, because the first is full
   of the current block. */
#if defined(__GNUC__)
#define DEM__PREFETCH(address) __builtin_prefetch(address, 0, 2)
#else
#define DEM__PREFETCH(address) ((void)(address))
#endif

/* gcc: the law's loop writes its results directly to the contacts; ivdep promises that no iteration reads what another
   one writes. Clang's pragma would also promise that arrays do not alias within an iteration, which is wrong here, so
   with clang the loop writes to rows, which are copied afterwards. gcc unrolls a short loop before it tries to
   vectorise it; `unroll 1` prevents that. */
#if defined(__GNUC__) && !defined(__clang__)
#define DEM__INDEPENDENT _Pragma("GCC ivdep")
#define DEM__NO_UNROLL _Pragma("GCC unroll 1")
#define DEM__COPY_ROWS 0
#else
#define DEM__INDEPENDENT
#define DEM__NO_UNROLL
#define DEM__COPY_ROWS 1
#endif

/* x86-64: the loops that vectorise are compiled twice, with AVX2 and without. The bits are the same, because neither
   version fuses. Not at -O0, nor by gcc at -Os, where loops do not vectorise. Not on Windows, where gcc does not align
   the stack for wide vectors (its bug 54412); there -mavx2 for the whole program gives the speed. */
#if defined(__GNUC__) && defined(__x86_64__) && !defined(__AVX2__) && !defined(_WIN32) && defined(__OPTIMIZE__) &&     \
    (defined(__clang__) || !defined(__OPTIMIZE_SIZE__))
#define DEM__AVX2_CLONE(name, parameters, arguments, call)                                                             \
    __attribute__((target("avx2"))) DEM__FAST DEM__STATIC void name##_wide parameters { call; }                        \
    DEM__FAST DEM__STATIC void name parameters {                                                                       \
        if (__builtin_cpu_supports("avx2")) name##_wide arguments;                                                     \
        else call;                                                                                                     \
    }
#else
#define DEM__AVX2_CLONE(name, parameters, arguments, call)                                                             \
    DEM__FAST DEM__STATIC void name parameters { call; }
#endif
