/* wet.c - liquid bridges for Python (dem.Law): the laws of dem_wet.h for worlds with a wire screen. The first run of a
   world puts an equal film on every sphere, by the moisture and the screen's wall that law_set gave last.
   Groups 0, 1, 2 are size classes. One thread at a time. From the repository's root:

   cc -O3 -ffp-contract=off -fno-math-errno -fno-trapping-math -fPIC -shared -I. python/laws/wet.c -lm -o wet.so */
#include "dem_wet.h"

/* The books of one world, which points to them: world->user is the scene. */
typedef struct wet_books {
    wet_scene scene;
    const dem_world *world;
    ptrdiff_t ids; /* particles with ids below have films */
    int *group;
    struct wet_books *next;
} wet_books;

static wet_books *all_books;
static double moisture = 0.025, bridges, liquid;
static int deck = 0;

size_t law_world_size(void);
int law_set(const char *name, double value);
double law_get(const char *name);
dem_status law_run(dem_world *world, double duration);
void law_forget(const dem_world *world);

size_t law_world_size(void) { return sizeof(dem_world); }

/* moisture: liquid over mass of particles [-] 0 .. 1, default 0.025; deck: wall index of the screen, default 0. For
   worlds that have not run yet. Returns 0, or 1 for another name, 2 for a value outside its range. */
int law_set(const char *name, double value) {
    if (strcmp(name, "moisture") == 0) {
        if (!(value >= 0.0 && value <= 1.0)) return 2;
        moisture = value;
    } else if (strcmp(name, "deck") == 0) {
        if (!(value >= 0.0 && value < DEM_WALLS_MAX) || value != floor(value)) return 2;
        deck = (int)value;
    } else return 1;
    return 0;
}

/* bridges: their number, liquid: in films and bridges [m3], of the world that ran last, at the end of its run;
   moisture, deck: as set. NaN for other names. */
double law_get(const char *name) {
    return strcmp(name, "bridges") == 0    ? bridges
           : strcmp(name, "liquid") == 0   ? liquid
           : strcmp(name, "moisture") == 0 ? moisture
           : strcmp(name, "deck") == 0     ? deck
                                           : (double)NAN;
}

static void free_books(wet_books *books) {
    wet_free(&books->scene);
    free(books->group);
    free(books);
}

/* Called before a world is freed. */
void law_forget(const dem_world *world) {
    for (wet_books **at = &all_books; *at; at = &(*at)->next) {
        wet_books *books = *at;
        if (books->world != world) continue;
        *at = books->next;
        free_books(books);
        return;
    }
}

static dem_status wet_the_spheres(wet_books *books, dem_world *world, double *diameters) {
    double classes[WET_CLASSES] = {0.0, 0.0, 0.0}, mass = 0.0, largest = 0.0;
    for (ptrdiff_t i = 0; i < world->count; i++) {
        if (!world->alive[i]) continue;
        const int group = world->group[i];
        const double diameter = 2.0 * dem_radius(world, i);
        if (group < 0 || group >= WET_CLASSES) return DEM_BAD_ARGUMENT;
        books->group[world->id[i]] = group;
        diameters[world->id[i]] = diameter;
        classes[group] = diameter;
        mass += dem_mass(world, i);
        largest = diameter > largest ? diameter : largest;
    }
    for (int c = 0; c < WET_CLASSES; c++) classes[c] = classes[c] > 0.0 ? classes[c] : largest;
    const bridge_status status = wet_init(&books->scene, (int)books->ids, books->group, diameters, classes, moisture,
                                          mass, deck, world, false, WET_STEEL);
    return status == BRIDGE_OK ? DEM_OK : DEM_BAD_ARGUMENT;
}

/* Number of ids up to the largest in the world. */
static ptrdiff_t ids_of(const dem_world *world) {
    ptrdiff_t ids = 0;
    for (ptrdiff_t i = 0; i < world->count; i++)
        if (world->alive[i] && (ptrdiff_t)world->id[i] >= ids) ids = (ptrdiff_t)world->id[i] + 1;
    return ids;
}

static dem_status begin(dem_world *world) {
    const ptrdiff_t ids = ids_of(world);
    if (deck >= world->walls || ids < 1 || ids > INT32_MAX) return DEM_BAD_ARGUMENT;
    if (dem_link_count(world) > 0) return DEM_LAW_MISMATCH; /* its films are not saved with a world */
    /* Another world at the same address, which was freed unseen. */
    law_forget(world);
    wet_books *books = calloc(1, sizeof *books);
    double *diameters = calloc((size_t)ids, sizeof *diameters);
    if (books) books->group = calloc((size_t)ids, sizeof *books->group);
    dem_status status = books && books->group && diameters ? DEM_OK : DEM_OUT_OF_MEMORY;
    if (status == DEM_OK) books->ids = ids, status = wet_the_spheres(books, world, diameters);
    free(diameters);
    if (status == DEM_OK) {
        books->world = world;
        books->next = all_books;
        all_books = books;
        world->user = &books->scene;
    } else if (books) free_books(books);
    return status;
}

dem_status law_run(dem_world *world, double duration) {
    if (!world->user) {
        const dem_status status = begin(world);
        if (status != DEM_OK) return status;
    }
    const wet_books *books = all_books;
    while (books && !(books->world == world && world->user == &books->scene)) books = books->next;
    if (!books) return DEM_LAW_MISMATCH;                     /* another law's world */
    if (ids_of(world) > books->ids) return DEM_BAD_ARGUMENT; /* particles that came later have no films */
    const dem_status status = wet_run(world, duration, 0);
    int count = 0;
    liquid = wet_total(&books->scene, world, &count);
    bridges = count;
    return status;
}
