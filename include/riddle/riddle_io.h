#include "../../riddle_io.h"
