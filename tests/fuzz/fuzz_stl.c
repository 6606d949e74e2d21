/* The STL reader: any bytes give a mesh whose indices and report agree with themselves and that a world takes as a
   wall, or a status. */
#include "fuzz.h"

#include "dem.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    dem_mesh mesh;
    dem_stl_report report;
    const dem_status status = dem_read_stl(bytes, size, 1e-3, size % 2 ? 1e-6 : 0.0, NULL, &mesh, &report);
    FUZZ_ASSERT((status == DEM_OK) == (mesh.triangles > 0) &&
                (status == DEM_OK || (status == DEM_BAD_DATA && !mesh.block)));
    FUZZ_ASSERT(mesh.triangles <= report.facets - report.not_finite - report.degenerate - report.duplicate &&
                report.missing >= 0);
    FUZZ_ASSERT(report.open_edges + 2 * report.inconsistent + 3 * report.nonmanifold <=
                3 * (mesh.triangles + report.degenerate));
    for (ptrdiff_t k = 0; k < 3 * mesh.triangles; k++)
        FUZZ_ASSERT(mesh.triangle[k] >= 0 && mesh.triangle[k] < mesh.vertices);
    if (status == DEM_OK) {
        dem_world world;
        dem_def def = dem_default_def();
        dem_add_material(&def, 2500.0, 1e8, 0.2);
        FUZZ_ASSERT(dem_init(&world, &def, NULL) == DEM_OK);
        const int wall = dem_add_mesh(&world, 0, &mesh); /* far from the origin, round-off may leave no area */
        FUZZ_ASSERT(wall == 0 || wall == -(int)DEM_BAD_ARGUMENT);
        dem_free(&world);
    }
    dem_free_mesh(&mesh);
    return 0;
}

#define FACET "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 -0.5\nendloop\nendfacet\n"
static const char *const samples[] = {
    "solid a\n" FACET
    "facet normal 0 0 -1\r\nouter loop\nvertex 1 0 0\nvertex 0 0 0\nvertex 0 -1 .25E+1\nendloop\nendfacet\n" FACET
    "endsolid\n",
    "SOLID\n" FACET "facet normal nan 0 1\nvertex 1e999 0 0\nvertex 1 1 1\nvertex 2 2 2\n",
    "binary file of eighty bytes, whose head is text, as the samples of this fuzzer end at a zero byte\x3f"
    "\1\1\1\1\1\1\1\1\1\1\1\1\2\2\2\77\3\3\3\77\4\4\4\77\5\5\5\100\6\6\6\100\7\7\7\77\10\10\10\101\11\11\11\77\12\12\12"
    "\77..."
    "\1\1\1\1\1\1\1\1\1\1\1\1\3\3\3\77\2\2\2\77\4\4\4\77\5\5\5\77\6\6\6\100\7\7\7\77\10\10\10\77\11\11\11\77\12\12\12"
    "\77.",
    "",
};

FUZZ_MAIN(samples, 4, 20000)
