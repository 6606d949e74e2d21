/* contact_models.h: the laws of dem_laws.h by name, with their compiled loops. For one file of a program: it takes a
   quarter of a minute. */
#ifndef RIDDLE_CONTACT_MODELS_H
#define RIDDLE_CONTACT_MODELS_H

#include "dem_laws.h"

DEM_KERNEL(contact_models_epsd, contact_epsd, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING)
DEM_KERNEL(contact_models_epsd_hertz, contact_epsd_hertz, DEM_HERTZ | DEM_FRICTION | DEM_ROLLING)
DEM_KERNEL(contact_models_dmt, contact_dmt, DEM_HERTZ | DEM_FRICTION)
DEM_KERNEL(contact_models_jkr, contact_jkr, DEM_HERTZ | DEM_FRICTION)
DEM_KERNEL(contact_models_bonds, contact_bonds, DEM_LINEAR | DEM_FRICTION | DEM_ROLLING)

typedef enum contact_model {
    CONTACT_MODEL_EPSD,
    CONTACT_MODEL_EPSD_HERTZ,
    CONTACT_MODEL_DMT,
    CONTACT_MODEL_JKR,
    CONTACT_MODEL_BONDS,
    CONTACT_MODELS
} contact_model;

static const struct {
    const char *name;
    const dem_kernel *kernel;
} contact_models[CONTACT_MODELS] = {{"epsd", &contact_models_epsd},
                                    {"epsd_hertz", &contact_models_epsd_hertz},
                                    {"dmt", &contact_models_dmt},
                                    {"jkr", &contact_models_jkr},
                                    {"bonds", &contact_models_bonds}};

#endif
