#include "../../liquid_bridge.h"
