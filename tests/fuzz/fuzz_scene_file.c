/* Scene files: any bytes give a scene that a world can be made of, or one line that names the place. */
#include "fuzz.h"

#include "riddle/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    tree_file file;
    scene_def def;
    scene s;
    int failed = tree_read(&file, "scene.yaml", (const char *)bytes, size) || scene_read(&file, &def);
    if (!failed) {
        def.liquid.part.where = NULL; /* its tables take long */
        failed = scene_make(&s, &def, &file, 1, 1);
        FUZZ_ASSERT(failed || (s.tick > 0.0 && s.sources > 0 && s.groups > 0 && s.world.def.dt > 0.0));
        for (int k = 0; k < s.sources; k++)
            FUZZ_ASSERT(failed || (s.source[k].feed && s.source[k].density > 0.0 && s.source[k].cube > 0.0));
        scene_free(&s);
    }
    FUZZ_ASSERT(failed == (file.message[0] != '\0' ? -1 : 0) || failed == 1);
    FUZZ_ASSERT(!failed || strncmp(file.message, "scene.yaml:", 11) == 0);
    FUZZ_ASSERT(!strchr(file.message, '\n'));
    tree_free(&file);
    return 0;
}

#define SHAPES                                                                                                         \
    "shapes:\n  rod: {spheres: [{centre: [0, 0, 0], diameter: 4 mm}, {centre: [3 mm, 0, 0], diameter: 4 mm}]}\n  "     \
    "box: {box: [4 mm, 5 mm, "                                                                                         \
    "6 "                                                                                                               \
    "mm], rounding: 0.1}\n  wedge: {corners: [[0, 0, 0], [1 mm, 0, 0], [0, 1 mm, 0], [0, 0, 1 mm]]}\n"
#define REGION "region: {box: {low: [0, 0, 0], high: [0.1, 0.1, 10 mm]}}"
#define HEAD "duration: 2 s\nmaterials:\n  g: {density: 2500 kg/m3}\n"
#define FEED                                                                                                           \
    "feeds:\n  - {material: g, mass: 1 g, sizes: {diameter: 3 mm}, region: {box: {low: [0, 0, 0], high: [0.1, 0.1, "   \
    "10 mm]}}}\n"
static const char *const samples[] = {
    HEAD FEED
    "walls:\n  a: {material: g, screen: {aperture: 6 mm, wire: 1 mm, radius: 1 cm}, vibrate: &v {amplitude: [0, 0, 1 "
    "mm], "
    "frequency: 20 Hz}}\n  b: {material: g, plane: {normal: [1, 0, 0]}, vibrate: *v, until: 1 s}\n  c: {exit: {}}\n",
    HEAD FEED "walls:\n  a: {material: g, box: {size: [1, 2, 3 mm], axis: [1, 1, 1], angle: 30 deg, open: top}}\n  l: "
              "{material: g, lifters: "
              "{count: 6, radius: 5 cm, height: 1 cm, thickness: 3 mm, length: 2 cm, tilt: 0.1 rad}, rotate: {axis: "
              "[0, 1, 0], speed: 3 rpm}}\n",
    HEAD "contacts:\n  - {between: [g, g], stiffness: 1e3, friction: 0}\nfeeds:\n  - material: g\n    rate: 2 t/h\n    "
         "region: {sphere: "
         "{centre: [0, 0, 0], radius: 1 cm}}\n    sizes:\n      classes: [{diameter: 1 mm, share: 30 %}, {diameter: 2 "
         "mm}]\n      shares: "
         "number\n",
    "{\"duration\": 1, \"materials\": {\"g\": {\"density\": 2500}}, \"law\": \"hertz\", \"feeds\": [{\"material\": "
    "\"g\", \"count\": 10, "
    "\"sizes\": {\"lognormal\": {\"median\": \"3 mm\", \"spread\": 0.2, \"smallest\": 0.002, \"largest\": 0.005}}, "
    "\"region\": "
    "{\"cylinder\": "
    "{\"bottom\": [0,0,0], \"length\": 1, \"radius\": 0.1}}}]}",
    "liquid: {moisture: 2 %}\nstop:\n  - {column: particles, below: 1}\nmeasure: {every: 10 ms, regions: {a: {region: "
    "{box: {low: [0, 0, "
    "0], "
    "high: [1, 1, 1]}}}}}\nperiodic: {x: {low: 0, high: 1}}\noutput: {movie: yes, frames: 1e-1}\ngravity: [0, nan, "
    "-inf]\n",
    HEAD SHAPES
    "feeds:\n  - {material: g, shape: rod, mass: 1 g, sizes: {uniform: {smallest: 1 mm, largest: 2 mm}}, " REGION
    "}\n  - {material: g, shape: box, count: 3, sizes: {diameter: 3 mm}, " REGION
    "}\n  - {material: g, shape: wedge, rate: 1 g/s, " REGION "}\n",
    "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[&a [*a, *a], *b, <<: *a, ? x, !!binary x, %YAML 1.1\n---\n...\n--- \"\\0\" |\n  "
    "x\n",
};

FUZZ_MAIN(samples, 7, 6000)
