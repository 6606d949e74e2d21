/* scene_laws.c: see scene_laws.h */
#include "scene_laws.h"

#include <math.h>
#include <stdlib.h>

#include "contact_models.h"
#include "scene_feed.h"
#include "scene_walls.h"

static const char *const words[] = {"linear", "hertz", "epsd", "epsd_hertz", "dmt", "jkr", "bonds"};

static int is_named(int law) { return law >= LAW_EPSD; }
static const dem_kernel *kernel_of(const scene *s) { return contact_models[s->def->law - LAW_EPSD].kernel; }

/* Keys of a contact that not every law knows, and which do. */
static const struct {
    const char *key;
    int laws;
} known[] = {{"rolling", 1 << LAW_LINEAR | 1 << LAW_HERTZ},
             {"rolling_coefficient", 1 << LAW_EPSD | 1 << LAW_EPSD_HERTZ},
             {"rolling_damping", 1 << LAW_EPSD | 1 << LAW_EPSD_HERTZ},
             {"twisting_coefficient", 1 << LAW_EPSD | 1 << LAW_EPSD_HERTZ},
             {"surface_energy", 1 << LAW_DMT | 1 << LAW_JKR},
             {"bond", 1 << LAW_BONDS}};

static int check_keys(const scene *s, const contact_def *c) {
    char laws[80] = "";
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        const tree *at = tree_find(c->part.where, known[k].key);
        if (!at || known[k].laws >> s->def->law & 1) continue;
        for (size_t l = 0, used = 0; l < sizeof words / sizeof *words; l++)
            if (known[k].laws >> l & 1)
                used += (size_t)snprintf(laws + used, sizeof laws - used, "%s%s", used ? " or " : "", words[l]);
        return tree_fail(s->file, at, "%s: only with law: %s; the scene has law: %s", known[k].key, laws,
                         words[s->def->law]);
    }
    return 0;
}

static void fill_pair(contact_pair_def *p, const contact_def *c) {
    p->rolling = c->rolling_coefficient, p->rolling_damping = c->rolling_damping;
    p->twisting = c->twisting_coefficient;
    p->surface_energy = c->surface_energy;
    if (!c->bond.part.where) return;
    p->bond_modulus = c->bond.modulus, p->bond_shear = c->bond.shear_ratio, p->bond_radius = c->bond.radius;
    p->bond_damping = c->bond.damping, p->tensile = c->bond.tensile, p->shear = c->bond.shear;
}

/* Polyhedra touch at several points, and a bond would begin at each; a law of rolling counts on one. */
static int check_shapes(const scene *s) {
    for (int k = 0; k < s->sources; k++) {
        const body_shape *b = s->source[k].shape;
        if (b && (s->def->law == LAW_BONDS || b->clump.spheres == 0))
            return tree_fail(s->file, fields_where(&s->def->part, "law"),
                             "law: %s: only for %s, and a feed has the shape %.60s", words[s->def->law],
                             s->def->law == LAW_BONDS ? "spheres" : "spheres and clumps", s->source[k].def->shape);
    }
    return 0;
}

int scene_laws_begin(scene *s) {
    const contact_def *c = s->def->contacts.item;
    const tree *bond_at = tree_find(s->def->part.where, "bond_at");
    for (int k = 0; k < s->def->contacts.n; k++)
        if (check_keys(s, &c[k])) return -1;
    if (bond_at && s->def->law != LAW_BONDS) return tree_fail(s->file, bond_at, "bond_at: only with law: bonds");
    if (!is_named(s->def->law)) return 0;
    if (s->def->law == LAW_BONDS && !bond_at)
        return tree_fail(s->file, fields_where(&s->def->part, "law"),
                         "law: bonds: bond_at is missing, the time at which what touches becomes a bond");
    if (check_shapes(s)) return -1;
    s->laws = malloc(sizeof *s->laws);
    if (!s->laws) return tree_fail(s->file, NULL, "out of memory");
    *s->laws = contact_default_laws();
    for (int k = 0; k < s->def->contacts.n; k++) {
        int a = 0, b = 0; /* known: the definition has them */
        if (scene_material(s->file, s->def, &c[k].part, "between", c[k].between[0], &a) ||
            scene_material(s->file, s->def, &c[k].part, "between", c[k].between[1], &b))
            return -1;
        fill_pair(contact_pair(s->laws, a, b), &c[k]);
    }
    s->features = kernel_of(s)->features;
    return 0;
}

void scene_laws_free(scene *s) {
    free(s->laws);
    s->laws = NULL;
}

/* A twentieth of sqrt(m/k), with k = E pi (bond radius)^2/(2 R) between two of the smallest spheres, which a
   wall shares. */
double scene_laws_step(const scene *s) {
    const contact_def *c = s->def->contacts.item;
    double least = HUGE_VAL;
    for (int k = 0; k < s->def->contacts.n; k++)
        for (int q = 0; q < s->sources && c[k].bond.part.where; q++) {
            double low, high;
            scene_extremes(&s->source[q], &low, &high);
            least = fmin(least, 0.05 * low / c[k].bond.radius * sqrt(s->source[q].density / (3.0 * c[k].bond.modulus)));
        }
    return least;
}

dem_status scene_laws_run(scene *s, double now, double duration) {
    const double at = s->def->bond_at, soon = now + 1e-9 * s->tick;
    dem_status status = DEM_OK;
    s->world.user = s->laws; /* a world that was loaded has none */
    if (soon >= at && soon - s->tick < at) { /* the first tick that begins then, also of a run that goes on */
        status = dem_run_law(&s->world, 0.0, kernel_of(s));
        if (status == DEM_OK) contact_bond_touching(&s->world);
    }
    return status == DEM_OK ? dem_run_law(&s->world, duration, kernel_of(s)) : status;
}

int scene_laws_bonds(const scene *s) {
    int whole = 0;
    for (ptrdiff_t k = 0; k < dem_contact_count(&s->world); k++) whole += contact_is_bond(&s->world, k);
    return whole;
}
