/* The one compiled copy of a header, RIDDLE_COPIED (base/meson.build). */
#include RIDDLE_COPIED
