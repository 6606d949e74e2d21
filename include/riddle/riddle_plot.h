#include "../../riddle_plot.h"
