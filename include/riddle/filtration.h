#include "../../filtration.h"
