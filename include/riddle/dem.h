#include "../../dem.h"
