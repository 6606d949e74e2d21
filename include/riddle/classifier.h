#include "../../classifier.h"
