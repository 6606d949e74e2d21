#include "../../granulation.h"
