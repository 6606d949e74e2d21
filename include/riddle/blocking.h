#include "../../blocking.h"
