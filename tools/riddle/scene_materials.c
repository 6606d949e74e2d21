/* scene_materials.c: see scene_materials.h */
#include "scene_materials.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct ready_material {
    const char *name;
    double density, young_modulus, poisson_ratio; /* [kg/m3], [Pa] */
    const char *begin_with;                       /* of contacts */
    const char *source;
} ready_material;

static const ready_material ready[] = {
    {"glass", 2500.0, 7.0e10, 0.2,
     "with itself restitution 0.78, friction 0.20; with steel 0.44 and 0.29 (spheres of 5 to 10 mm)",
     "EN 572-1:2012 (soda lime glass); contacts: Elskamp & Kruggel-Emden (2018), table 4"},
    {"steel", 7850.0, 2.1e11, 0.3, "-", "EN 1993-1-1:2005, 3.2.6; density: EN 1991-1-1:2002, table A.4"},
    {"pvc", 1300.0, 2.2e9, 0.4, "-", "Elskamp & Kruggel-Emden (2018), table 2"},
    {"limestone", 2700.0, 2.71e10, 0.25,
     "restitution 0.3 of crushed grains at 1 to 40 m/s; friction from a shear test or an angle of repose",
     "Weers et al. (2022): density, modulus, restitution; Poisson's ratio: Chung & Ooi (2011)"},
    {"wheat", 1300.0, 1e9, 0.3, "friction from an angle of repose: 34 degrees poured, in EN 1991-4:2006, table E.1",
     "density of kernels: ASAE D241.4 (hard red winter, 10 % moisture); modulus and Poisson's ratio: order of "
     "magnitude only"},
    {"polypropylene", 900.0, 1.2e9, 0.42, "pellets: friction from an angle of repose",
     "Ashby, Materials Selection in Mechanical Design (2011), appendix A: middle of the ranges"},
};
enum { READY = sizeof ready / sizeof *ready };

static int has_key(const material_def *m, const char *key) { return tree_find(m->part.where, key) != NULL; }

int scene_fill_material(tree_file *file, material_def *m) {
    const char *names[READY];
    if (!m->ready)
        return has_key(m, "density")
                   ? 0
                   : tree_fail(file, m->part.where,
                               "material: density is missing (or ready: the name of a ready material)");
    for (int k = 0; k < READY; k++) {
        names[k] = ready[k].name;
        if (strcmp(m->ready, ready[k].name) != 0) continue;
        if (!has_key(m, "density")) m->density = ready[k].density;
        if (!has_key(m, "young_modulus")) m->young_modulus = ready[k].young_modulus;
        if (!has_key(m, "poisson_ratio")) m->poisson_ratio = ready[k].poisson_ratio;
        tree_note(file, m->part.where,
                  "%s: density %g kg/m3, E %g GPa, Poisson's ratio %g, to begin with: how it flows hangs on friction "
                  "and shape, "
                  "which are measured (riddle materials)",
                  m->ready, m->density, 1e-9 * m->young_modulus, m->poisson_ratio);
        return 0;
    }
    return fields_refuse_word(file, fields_where(&m->part, "ready"), "material", m->ready, names, READY);
}

void scene_list_materials(void) {
    printf("| ready | density [kg/m3] | Young's modulus [GPa] | Poisson's ratio | contacts to begin with | source "
           "|\n|---|---|---|---|---|---|\n");
    for (int k = 0; k < READY; k++)
        printf("| `%s` | %g | %g | %g | %s | %s |\n", ready[k].name, ready[k].density, 1e-9 * ready[k].young_modulus,
               ready[k].poisson_ratio, ready[k].begin_with, ready[k].source);
    printf("\nThese are values to begin with. Density and stiffness are those of the solid; how a material flows hangs "
           "on friction, rolling\n"
           "resistance and shape, which differ from lot to lot: measure an angle of repose, a bulk density or a flow, "
           "and fit the contacts to it.\n");
}
