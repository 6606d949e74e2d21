#include "../../dem_laws.h"
