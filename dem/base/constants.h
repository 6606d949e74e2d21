/* Constants that tune the engine, each with its reason. The public ones (DEM_ and one underscore) change only how much
   fits; the others change results in their last bits. Saves hold what is present, not what would fit: they load in a
   program with other public constants if everything fits. */
#pragma once

/* Materials of a world at most; -DDEM_MATERIALS_MAX=12 in all files of a program gives more. The default leaves a table
   of 64 pairs in the definition. */
#ifndef DEM_MATERIALS_MAX
#define DEM_MATERIALS_MAX 8
#endif
#define DEM_WALLS_MAX 32     /* every particle near a wall is tested with it; a mesh counts as one */
#define DEM_CONSTANTS_MAX 16 /* constants of a law, computed when a contact begins */
#define DEM_STATE_MAX 16     /* doubles that a law may keep for each contact */
/* Sets of constants that contacts share: enough for a few sizes and materials. */
#define DEM__TYPES_MAX 32
/* Contacts evaluated together: 30 arrays of a block fit into the first-level cache. */
#define DEM__BLOCK 64
/* Longest life of a list, and longest delay of a test, in steps. Rounding errors grow with it. */
#define DEM__STEPS_MAX (1 << 20)
/* Longest delay of a test at rotating walls, in steps. A further test after it costs little. */
#define DEM__RETEST_STEPS 1024
/* Flights in a field that a bound should last. With more of them, neighbours are tested sooner. */
#define DEM__FLIGHTS 8.0
#define DEM__AHEAD 16                     /* entries ahead for which memory is prefetched */
#define DEM__LINE 16                      /* timers of a line, which are compared together: a cache line */
#define DEM__PAGE (DEM__LINE * DEM__LINE) /* timers of a page: as many lines as a line has timers */
#define DEM__REORDER_STEPS 256            /* steps between two reorderings of contacts */
/* Steps that a list should last: building it takes as long as about thirty steps of a gas. */
#define DEM__LIST_STEPS 100
/* Near pairs for each sphere. With fewer, a wide skin costs little, and lists should last four times as long. */
#define DEM__FEW_PAIRS 3
/* Number of contacts from which on they lie in chunks, contacts of a chunk, and the most chunks, which is also the most
   threads that share contacts. The last block of a chunk is not full: chunks of six blocks would cost one thread 10 %.
   Their number is a multiple of 16, so that 16 threads have equal shares. */
#define DEM__CHUNKED 8192
#define DEM__OF_CHUNK (20 * DEM__BLOCK)
#define DEM__EQUAL_CHUNKS 16
#define DEM__CHUNKS 256
#define DEM__RANK_STEPS 2048 /* steps between two renewals of ranks, in which particles move little */
/* Steps of a run that pay for sorting particles in memory and back, which takes as long as three or four steps of a
   dense bed. */
#define DEM__MOVE_STEPS 64
#define DEM__SHARE 256       /* items that pay for waking a thread, at about 20 ns each */
#define DEM__PARTS_MAX 256 /* threads that share a step: arrays of this size lie on the stack */
/* Speeds, spins and histories of contacts are rounded to 2^-52 of this, so that what decays ends at 0. */
#define DEM__LEAST 1e-84
#define DEM__MAGIC 0x0a1a64656d52u /* first bytes of a saved world */
#define DEM__FORMAT 12u            /* version of its records: new fields do not change it */
