/* Collision of the nodes of a row, for doubles and for floats: kernel.h is a template. */
#pragma once
#include "lattice.h"

#define FILTRATION__REAL double
#define FILTRATION__FLAG int64_t
#define FILTRATION__OF(name) name##d
#include "kernel.h"
#undef FILTRATION__REAL
#undef FILTRATION__FLAG
#undef FILTRATION__OF
#define FILTRATION__REAL float
#define FILTRATION__FLAG int32_t
#define FILTRATION__OF(name) name##f
#include "kernel.h"
#undef FILTRATION__REAL
#undef FILTRATION__FLAG
#undef FILTRATION__OF
