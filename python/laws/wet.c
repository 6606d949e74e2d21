/* wet.c - liquid bridges for Python (dem.Law): the laws of examples/wet_contact.h for one world with a wire screen. law_set gives the
   moisture and the screen's wall; the first run puts an equal film on every sphere. Groups 0, 1, 2 are size classes. */
#include "examples/wet_contact.h"

static wet_scene scene;
static dem_world *of_world;
static double moisture = 0.025;
static int deck = 0;
static int *groups;

size_t law_world_size(void);
void law_set(const char *name, double value);
double law_get(const char *name);
dem_status law_run(dem_world *world, double duration);

size_t law_world_size(void) { return sizeof(dem_world); }

void law_set(const char *name, double value) {
    if (strcmp(name, "moisture") == 0) moisture = value;
    if (strcmp(name, "deck") == 0) deck = (int)value;
}

double law_get(const char *name) {
    int bridges = 0;
    const double liquid = of_world ? wet_total(&scene, of_world, &bridges) : 0.0;
    return strcmp(name, "bridges") == 0 ? bridges : liquid;
}

static dem_status wet_the_spheres(dem_world *world) {
    const size_t n = (size_t)world->count;
    double classes[WET_CLASSES] = {0.0, 0.0, 0.0}, mass = 0.0, largest = 0.0;
    double *diameters = malloc(n * sizeof *diameters);
    groups = malloc(n * sizeof *groups);
    if (!diameters || !groups || deck < 0 || deck >= world->walls) return DEM_BAD_ARGUMENT;
    for (size_t i = 0; i < n; i++) {
        groups[i] = world->group[i];
        diameters[i] = 2.0 * dem_radius(world, i);
        mass += dem_mass(world, i);
        if (groups[i] < 0 || groups[i] >= WET_CLASSES) return DEM_BAD_ARGUMENT;
        classes[groups[i]] = diameters[i];
        largest = diameters[i] > largest ? diameters[i] : largest;
    }
    for (int c = 0; c < WET_CLASSES; c++) classes[c] = classes[c] > 0.0 ? classes[c] : largest;
    const bridge_status status = wet_init(&scene, (int)n, groups, diameters, classes, moisture, mass, deck, world, false, WET_STEEL);
    free(diameters);
    world->user = &scene;
    of_world = world;
    return status == BRIDGE_OK ? DEM_OK : DEM_BAD_ARGUMENT;
}

dem_status law_run(dem_world *world, double duration) {
    if (world != of_world) {
        const dem_status status = wet_the_spheres(world);
        if (status != DEM_OK) return status;
    }
    return wet_run(world, duration, 0);
}
