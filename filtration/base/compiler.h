/* What compilers call differently, and the switch between static inline and one shared copy. */
#pragma once
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "filtration.h needs NaN and exact arithmetic: compile without -ffast-math and -ffinite-math-only"
#endif

#ifndef FILTRATION_API
#define FILTRATION_API static inline
#define FILTRATION__BODIES
#elif defined(FILTRATION_IMPLEMENTATION)
#define FILTRATION__BODIES
#endif

/* At -O2 gcc does not vectorise a loop if its arithmetic may trap or a root may set errno. Functions that are compiled
   for several machines therefore bring their own options, the others those of the header. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__) && !defined(__OPTIMIZE_SIZE__) &&                \
    !defined(__SANITIZE_ADDRESS__)
#define FILTRATION__FAST __attribute__((optimize("O3", "no-math-errno", "no-trapping-math", "fp-contract=off")))
#else
#define FILTRATION__FAST
#endif

#if defined(__GNUC__)
#define FILTRATION__INLINE static inline __attribute__((always_inline)) FILTRATION__FAST
#elif defined(_MSC_VER)
#define FILTRATION__INLINE static __forceinline
#else
#define FILTRATION__INLINE static inline
#endif

/* Prefetches memory into the second cache. */
#if defined(__GNUC__)
#define FILTRATION__PREFETCH(address) __builtin_prefetch(address, 0, 2)
#else
#define FILTRATION__PREFETCH(address) ((void)(address))
#endif

/* No node of a row reads what another node of the row writes. */
#if defined(__clang__)
#define FILTRATION__INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define FILTRATION__INDEPENDENT _Pragma("GCC ivdep")
#else
#define FILTRATION__INDEPENDENT
#endif

/* Functions for which the compiler decides about inlining. Without optimisation they are declared inline, because gcc
   then emits every other static function, whether or not anything calls it. */
#if defined(__OPTIMIZE__) || !defined(__GNUC__)
#define FILTRATION__STATIC static
#else
#define FILTRATION__STATIC static inline
#endif

/* x86-64: the kernels are compiled three times, with AVX-512, with AVX2 and without. The bits are the same, because
   none fuses. AVX2 has too few registers for a node's populations. Not on Windows, where gcc does not align the stack
   for wide vectors (its bug 54412); there -mavx2 for the whole program gives the speed. */
#if defined(__GNUC__) && defined(__x86_64__) && !defined(__AVX2__) && !defined(_WIN32)
#if defined(__clang__)
#define FILTRATION__AVX512 "avx512vl,avx512dq"
#else
#define FILTRATION__AVX512 "avx512vl,avx512dq,prefer-vector-width=512"
#endif
#define FILTRATION__CLONES(name, parameters, arguments, call)                                                          \
    __attribute__((target(FILTRATION__AVX512))) FILTRATION__FAST FILTRATION__STATIC void name##_512 parameters {       \
        call;                                                                                                          \
    }                                                                                                                  \
    __attribute__((target("avx2"))) FILTRATION__FAST FILTRATION__STATIC void name##_256 parameters { call; }           \
    FILTRATION__FAST FILTRATION__STATIC void name parameters {                                                         \
        if (__builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")) name##_512 arguments;            \
        else if (__builtin_cpu_supports("avx2")) name##_256 arguments;                                                 \
        else call;                                                                                                     \
    }
#else
#define FILTRATION__CLONES(name, parameters, arguments, call)                                                          \
    FILTRATION__FAST FILTRATION__STATIC void name parameters { call; }
#endif
