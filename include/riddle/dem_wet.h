#include "../../dem_wet.h"
