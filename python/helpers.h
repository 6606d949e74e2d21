/* helpers.h - what Python needs of a world beside the headers' own functions: its records, and states of all particles by one call. */
#define RIDDLE_EXPORT extern

/* What is read as it is stored. */
typedef enum riddle_record { RIDDLE_IDS, RIDDLE_GROUPS, RIDDLE_MATERIALS, RIDDLE_PRESENT } riddle_record;
/* States of all particles, written as [count][3] or [count]. */
typedef enum riddle_state { RIDDLE_POSITIONS, RIDDLE_VELOCITIES, RIDDLE_SPINS, RIDDLE_RADII, RIDDLE_MASSES } riddle_state;

RIDDLE_EXPORT ptrdiff_t riddle_count(const dem_world *world);
RIDDLE_EXPORT double riddle_time(const dem_world *world);
RIDDLE_EXPORT int64_t riddle_step(const dem_world *world);
RIDDLE_EXPORT int riddle_walls(const dem_world *world);
RIDDLE_EXPORT double riddle_dt(const dem_world *world);
RIDDLE_EXPORT double riddle_density(const dem_world *world, int material); /* NaN: there is no such material */
RIDDLE_EXPORT uint64_t riddle_failed_id(const dem_world *world);
RIDDLE_EXPORT int riddle_failed_material(const dem_world *world, int which);
RIDDLE_EXPORT int64_t riddle_particle_steps(const dem_world *world);
RIDDLE_EXPORT ptrdiff_t riddle_passed_count(const dem_world *world);
RIDDLE_EXPORT void riddle_states(const dem_world *world, int what, double *out);
RIDDLE_EXPORT void riddle_records(const dem_world *world, int what, int64_t *out);
RIDDLE_EXPORT int riddle_is_present(const dem_world *world, ptrdiff_t i);
/* Sets the definition's function stop, or takes it out with NULL. Returns 0 where the definition came with one, which stays. */
RIDDLE_EXPORT int riddle_set_stop(dem_world *world, int (*stop)(void *user));

ptrdiff_t riddle_count(const dem_world *world) { return world->count; }
double riddle_time(const dem_world *world) { return world->time; }
int64_t riddle_step(const dem_world *world) { return world->step; }
int riddle_walls(const dem_world *world) { return world->walls; }
double riddle_dt(const dem_world *world) { return world->def.dt; }
double riddle_density(const dem_world *world, int material) {
    return material >= 0 && material < world->def.materials ? world->def.material[material].density : (double)NAN;
}
uint64_t riddle_failed_id(const dem_world *world) { return world->failed_id; }
int riddle_failed_material(const dem_world *world, int which) { return world->failed_pair[which]; }
int64_t riddle_particle_steps(const dem_world *world) { return world->particle_steps; }
ptrdiff_t riddle_passed_count(const dem_world *world) { return world->passed_count; }
int riddle_is_present(const dem_world *world, ptrdiff_t i) { return i >= 0 && i < world->count && world->alive[i]; }
int riddle_set_stop(dem_world *world, int (*stop)(void *user)) {
    if (stop && world->def.stop) return 0;
    world->def.stop = stop;
    return 1;
}

void riddle_states(const dem_world *world, int what, double *out) {
    for (ptrdiff_t i = 0; i < world->count; i++) {
        if (what == RIDDLE_RADII || what == RIDDLE_MASSES) {
            out[i] = what == RIDDLE_RADII ? dem_radius(world, i) : dem_mass(world, i);
            continue;
        }
        const dem_vec v = what == RIDDLE_POSITIONS    ? dem_position(world, i)
                          : what == RIDDLE_VELOCITIES ? dem_velocity(world, i)
                                                      : dem_spin(world, i);
        out[3 * i] = v.x, out[3 * i + 1] = v.y, out[3 * i + 2] = v.z;
    }
}

void riddle_records(const dem_world *world, int what, int64_t *out) {
    for (ptrdiff_t i = 0; i < world->count; i++)
        out[i] = what == RIDDLE_IDS         ? (int64_t)world->id[i]
                 : what == RIDDLE_GROUPS    ? world->group[i]
                 : what == RIDDLE_MATERIALS ? world->material[i]
                                            : world->alive[i];
}
