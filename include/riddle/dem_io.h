#include "../../dem_io.h"
