/* dem_user_law.c: a law of one's own beside the shipped ones; tests/check_dem reads its disassembly. */
#include "dem.h"

static double prepare_magnet(const dem_birth *birth, double *constants) {
    constants[DEM_LINEAR_CONSTANTS] = 1e-3; /* [N] */
    return dem_prepare_linear(birth, constants);
}
DEM_INLINE void force_magnet(const dem_contact *contact, double *state, dem_response *response) {
    dem_force_linear_friction(contact, state, response);
    response->normal -= contact->constants[DEM_LINEAR_CONSTANTS];
}
static const dem_law magnet = {
    "linear, with attraction", 1, 3, 3, 1, DEM_LINEAR_CONSTANTS + 1, prepare_magnet, force_magnet, NULL, NULL};
DEM_KERNEL(dem__kernel_magnet, magnet, DEM_LINEAR | DEM_FRICTION)

int main(int argc, char **argv) {
    dem_world world;
    dem_def def = dem_default_def();
    int m = dem_add_material(&def, 2500.0, 1e9, 0.2), features = argc > 1 ? argv[1][0] : DEM_LINEAR;
    dem_status status = dem_init(&world, &def, NULL);
    double centres[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0049}, diameters[2] = {0.005, 0.005};
    if (status == DEM_OK) status = dem_add_spheres(&world, 2, centres, diameters, m, 0);
#ifdef ONE_KERNEL /* of those shipped: compiled in half the time */
    if (status == DEM_OK) status = dem_run_law(&world, 1e-4, &dem__kernel_magnet);
    if (status == DEM_OK) status = dem_run(&world, 1e-4, DEM_LINEAR | DEM_FRICTION);
    (void)features;
#else
    if (status == DEM_OK)
        status =
            features == DEM_LINEAR ? dem_run_law(&world, 1e-4, &dem__kernel_magnet) : dem_run(&world, 1e-4, features);
#endif
    dem_free(&world);
    return status != DEM_OK;
}
