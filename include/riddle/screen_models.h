#include "../../screen_models.h"
