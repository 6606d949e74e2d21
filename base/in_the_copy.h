/* Included before a program of this repository where each header has one compiled copy (base/meson.build). The public
   functions are compiled in base/copy.c, once, and called there. The bodies can be seen none the less: kernels of a
   program's own laws are made of the private functions, and tests call these. No public function is compiled again or
   inlined: gcc leaves out an `extern inline` function that it must not optimise, clang one that is never inlined. */
#if defined(__clang__)
#define RIDDLE_IN_THE_COPY extern inline __attribute__((gnu_inline, noinline))
#else
#define RIDDLE_IN_THE_COPY extern inline __attribute__((gnu_inline, optimize("O0")))
#endif

#ifndef DEM_API
#define DEM_API RIDDLE_IN_THE_COPY
#endif
#define DEM_IMPLEMENTATION
#ifndef DEM_IO_API
#define DEM_IO_API RIDDLE_IN_THE_COPY
#endif
#define DEM_IO_IMPLEMENTATION
#ifndef WET_API
#define WET_API RIDDLE_IN_THE_COPY
#endif
#define WET_IMPLEMENTATION
#ifndef CONTACT_API
#define CONTACT_API RIDDLE_IN_THE_COPY
#endif
#define CONTACT_IMPLEMENTATION
#ifndef BRIDGE_API
#define BRIDGE_API RIDDLE_IN_THE_COPY
#endif
#define BRIDGE_IMPLEMENTATION
#ifndef SCREEN_API
#define SCREEN_API RIDDLE_IN_THE_COPY
#endif
#define SCREEN_IMPLEMENTATION
#ifndef BLOCKING_API
#define BLOCKING_API RIDDLE_IN_THE_COPY
#endif
#define BLOCKING_IMPLEMENTATION
#ifndef GRANULATION_API
#define GRANULATION_API RIDDLE_IN_THE_COPY
#endif
#define GRANULATION_IMPLEMENTATION
#ifndef CLASSIFIER_API
#define CLASSIFIER_API RIDDLE_IN_THE_COPY
#endif
#define CLASSIFIER_IMPLEMENTATION
#ifndef FILTRATION_API
#define FILTRATION_API RIDDLE_IN_THE_COPY
#endif
#define FILTRATION_IMPLEMENTATION
