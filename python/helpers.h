/* helpers.h - what Python needs of a world beside the headers' own functions: its records, and states of all particles
   by one call. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RIDDLE_EXPORT extern

/* What is read as it is stored. */
typedef enum riddle_record { RIDDLE_IDS, RIDDLE_GROUPS, RIDDLE_MATERIALS, RIDDLE_PRESENT } riddle_record;
/* States of all particles, written as [count][3] or [count]. */
typedef enum riddle_state {
    RIDDLE_POSITIONS,
    RIDDLE_VELOCITIES,
    RIDDLE_SPINS,
    RIDDLE_RADII,
    RIDDLE_MASSES
} riddle_state;

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
/* Sets the definition's function stop, or takes it out with NULL. Returns 0 where the definition came with one,
   which stays. */
RIDDLE_EXPORT int riddle_set_stop(dem_world *world, int (*stop)(void *user));
/* kind, material, enabled, spin, coordinate, rate, work; position, velocity, normal, force, torque, impulse, angular
   impulse. Returns 1 where there is no such wall. */
RIDDLE_EXPORT int riddle_wall(const dem_world *world, int index, double *out);

/* The laws of dem_laws.h by name. A name's number, -1: there is none. Laws: the numbers of all pairs; pair: those of
   one, in the order of contact_pair_def, NULL for no pair. */
RIDDLE_EXPORT int riddle_contact_model(const char *name);
RIDDLE_EXPORT void *riddle_contact_laws(void);
RIDDLE_EXPORT void riddle_contact_free(void *laws);
RIDDLE_EXPORT double *riddle_contact_pair(void *laws, int a, int b);
RIDDLE_EXPORT const char *riddle_contact_bad_field(const void *laws);
RIDDLE_EXPORT int riddle_contact_run(dem_world *world, void *laws, int model, double duration);
RIDDLE_EXPORT int riddle_contact_bond(dem_world *world, void *laws, int model);
RIDDLE_EXPORT ptrdiff_t riddle_contact_bonds(const dem_world *world);

/* What riddle_io.h told of the last file that could not be written; empty where it told nothing. Asking forgets it at
   the next file. */
RIDDLE_EXPORT const char *riddle_last_line(void);
RIDDLE_EXPORT int riddle_picture(const dem_world *world, char **names, int n_names, double speed,
                                 const double *direction, int width, int height, unsigned char *rgb);
RIDDLE_EXPORT int riddle_section(const dem_world *world, const char *title, const double *point, const double *normal,
                                 const double *right, char **names, int n_names, const char *folder, const char *name);
RIDDLE_EXPORT void *riddle_series_open(const char *folder, const char *name);
RIDDLE_EXPORT int riddle_series_add(void *series, const dem_world *world);
RIDDLE_EXPORT int riddle_series_close(void *series);

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

int riddle_wall(const dem_world *world, int index, double *out) {
    if (index < 0 || index >= world->walls) return 1;
    const dem_wall *w = &world->wall[index];
    const double numbers[7] = {w->kind, w->material, w->enabled, w->spin, w->coordinate, w->rate, w->work};
    const dem_vec vectors[7] = {w->position, w->velocity, w->axis[2],        w->force,
                                w->torque,   w->impulse,  w->angular_impulse};
    for (int k = 0; k < 7; k++) {
        out[k] = numbers[k];
        out[7 + 3 * k] = vectors[k].x, out[8 + 3 * k] = vectors[k].y, out[9 + 3 * k] = vectors[k].z;
    }
    return 0;
}

/* ---- contact laws by name ---- */

#include "examples/common/contact_models.h"

int riddle_contact_model(const char *name) {
    for (int k = 0; k < CONTACT_MODELS; k++)
        if (strcmp(contact_models[k].name, name) == 0) return k;
    return -1;
}
void *riddle_contact_laws(void) {
    contact_laws *laws = (contact_laws *)malloc(sizeof *laws);
    if (laws) *laws = contact_default_laws();
    return laws;
}
void riddle_contact_free(void *laws) { free(laws); }
double *riddle_contact_pair(void *laws, int a, int b) { return (double *)contact_pair((contact_laws *)laws, a, b); }
const char *riddle_contact_bad_field(const void *laws) { return contact_bad_field((const contact_laws *)laws); }

/* The world has the laws only while it runs, so that nothing of it points to what Python has freed. */
int riddle_contact_run(dem_world *world, void *laws, int model, double duration) {
    void *before = world->user;
    world->user = laws;
    const dem_status status = dem_run_law(world, duration, contact_models[model].kernel);
    world->user = before;
    return (int)status;
}
int riddle_contact_bond(dem_world *world, void *laws, int model) {
    const int status = riddle_contact_run(world, laws, model, 0.0);
    void *before = world->user;
    world->user = laws;
    if (status == 0) contact_bond_touching(world);
    world->user = before;
    return status;
}
ptrdiff_t riddle_contact_bonds(const dem_world *world) {
    ptrdiff_t whole = 0;
    for (ptrdiff_t k = 0; k < dem_contact_count(world); k++) whole += contact_is_bond(world, k);
    return whole;
}

/* ---- files and pictures ---- */

static char riddle_line[600]; /* one thread at a time holds the interpreter's lock */
static void riddle_tell(const char *line) { snprintf(riddle_line, sizeof riddle_line, "%s", line); }
const char *riddle_last_line(void) { return riddle_line; }

#define RIDDLE_IO_API extern
#define RIDDLE_IO_IMPLEMENTATION
#define RIDDLE_IO_FAIL(line) riddle_tell(line)
#define RIDDLE_PLOT_API extern
#define RIDDLE_PLOT_IMPLEMENTATION
#define DEM_IO_API extern
#define DEM_IO_IMPLEMENTATION
#include "dem_io.h"

#include "examples/common/world_picture.h"

/* What render.c says; it says nothing but that memory is short. */
int common_fail(const char *format, ...) { return (void)format, -1; }
void common_print(const char *format, ...) { (void)format; }

int riddle_picture(const dem_world *world, char **names, int n_names, double speed, const double *direction, int width,
                   int height, unsigned char *rgb) {
    picture_def look = {{NULL}, n_names, speed, {direction[0], direction[1], direction[2]}, {width, height}};
    for (int k = 0; k < n_names; k++) look.names[k] = names[k];
    picture *s = picture_of_world(world, &look);
    const int status = s ? picture_draw(s, rgb) : -1;
    picture_free(s);
    return status;
}

int riddle_section(const dem_world *world, const char *title, const double *point, const double *normal,
                   const double *right, char **names, int n_names, const char *folder, const char *name) {
    riddle_line[0] = 0;
    riddle_plot *figure = riddle_plot_new(title, 1, 1);
    const dem_status status =
        dem_io_section(world, figure, dem_vec3(point[0], point[1], point[2]), dem_vec3(normal[0], normal[1], normal[2]),
                       dem_vec3(right[0], right[1], right[2]), n_names ? (const char *const *)names : NULL, n_names);
    const int written = (int)riddle_plot_write(figure, folder, name);
    return status ? (int)status : written;
}

/* A series keeps its names. */
typedef struct riddle_frames {
    dem_io_series series;
    char *names;
} riddle_frames;

void *riddle_series_open(const char *folder, const char *name) {
    const size_t length = strlen(folder) + 1, more = strlen(name) + 1;
    riddle_frames *f = (riddle_frames *)malloc(sizeof *f);
    riddle_line[0] = 0;
    if (!f) return NULL;
    f->names = (char *)malloc(length + more);
    if (f->names) {
        memcpy(f->names, folder, length);
        memcpy(f->names + length, name, more);
        f->series = dem_io_open(f->names, f->names + length);
        if (f->series.particles) return f;
        free(f->names);
    }
    free(f);
    return NULL;
}

int riddle_series_add(void *series, const dem_world *world) {
    riddle_line[0] = 0;
    return (int)dem_io_add(&((riddle_frames *)series)->series, world);
}

int riddle_series_close(void *series) {
    riddle_frames *f = (riddle_frames *)series;
    riddle_line[0] = 0;
    const int status = (int)dem_io_close(&f->series);
    free(f->names);
    free(f);
    return status;
}
