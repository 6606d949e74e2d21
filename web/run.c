/* run.c - `riddle run` for a page: the program of tools/riddle, a slice at a time, and what the page draws. Files are
   the page's (files.js). One scene at a time; every function but page_open wants an open one. */
#define main riddle_main
#include "../tools/riddle/riddle.c"
#undef main

#include "world_picture.h"

#define EXPORT(name) __attribute__((export_name(#name))) name

enum { FLOATS = 5, CORNER = 4 };
static job now;
static picture_def look;
static float *points;  /* x, y, z, radius [m], colour as 65536 red + 256 green + blue */
static float *corners; /* x, y, z [m], colour; below 0: glass. Three a triangle */
static ptrdiff_t point_room, corner_room;
static int n_points, n_corners;

/* ---- the run ---- */

/* Opens the scene in the file scene.yaml. quick: a tenth of its duration. 0, or 2 with a line on the error stream. */
int EXPORT(page_open)(int quick) {
    char message[200];
    memset(&now, 0, sizeof now);
    now.saved = (double)NAN;
    now.file = "scene.yaml";
    now.self.name = "riddle", now.self.out = "out", now.self.json = "out/result.json";
    now.self.threads = 1, now.self.seed = 1, now.self.quick = quick != 0;
    now.self.started = machine_seconds();
    common_set_name("riddle");
    if (riddle_io_make_folder("out", message, sizeof message) != RIDDLE_IO_OK) return refuse(message);
    if (read_scene(&now, false)) return 2;
    memset(&look, 0, sizeof look);
    look.speed = now.def.output.colour == 1 ? now.def.output.top_speed : 0.0;
    tell_begin(&now);
    now.save_at = 0.0;
    return 0;
}

/* Runs for about so long [s] of the page's time. 1: goes on; 0: it is at its end. */
int EXPORT(page_run)(double seconds) {
    const double end = machine_seconds() + seconds;
    do {
        if (!advance(&now)) return 0;
    } while (machine_seconds() < end);
    return 1;
}

/* The last row, all files, the closing lines. The exit status of the program. */
int EXPORT(page_end)(void) {
    if (!now.halfway) now.stop = end_run(&now, now.stop);
    tell(&now, report_write(now.r));
    return common_exit_status();
}

/* out/measured.csv and out/curves.svg up to here. */
void EXPORT(page_so_far)(void) { report_write_so_far(now.r); }

/* The present state for ParaView: out/frame_particles.vtp, frame_walls.vtp, frame_polyhedra.vtp where there
   are polyhedra. */
void EXPORT(page_frame)(void) {
    dem_io_particles(&now.s.world, "out", "frame_particles.vtp");
    dem_io_walls(&now.s.world, "out", "frame_walls.vtp");
    if (dem_get_shape(&now.s.world, 0)) dem_io_polyhedra(&now.s.world, "out", "frame_polyhedra.vtp");
}

double EXPORT(page_time)(void) { return scene_time(&now.s); }
double EXPORT(page_duration)(void) { return now.def.duration; }
double EXPORT(page_particles)(void) {
    double n = 0.0;
    for (ptrdiff_t i = 0; i < now.s.world.count; i++) n += now.s.world.alive[i] != 0;
    return n;
}
uint64_t EXPORT(page_hash)(void) { return dem_hash(&now.s.world); }

/* ---- what is drawn ---- */

static int room_for(float **array, ptrdiff_t *room, ptrdiff_t wanted) {
    if (wanted <= *room) return 1;
    float *more = realloc(*array, 2 * (size_t)wanted * sizeof *more);
    if (!more) return 0;
    *array = more, *room = 2 * wanted;
    return 1;
}

static float number_of(picture_colour c) { return (float)(65536 * c.red + 256 * c.green + c.blue); }

/* The spheres that are there; their number is page_point_count. */
const float *EXPORT(page_points)(void) {
    const dem_world *w = &now.s.world;
    n_points = 0;
    if (!room_for(&points, &point_room, FLOATS * w->count)) return NULL;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i] || dem_shape_of(w, i) >= 0) continue;
        const dem_vec x = dem_position(w, i);
        float *p = points + FLOATS * n_points++;
        p[0] = (float)x.x, p[1] = (float)x.y, p[2] = (float)x.z, p[3] = (float)dem_radius(w, i);
        p[4] = number_of(colour_of(w, &look, i));
    }
    return points;
}
int EXPORT(page_point_count)(void) { return n_points; }

static void put_corners(const dem_io_surface *s, const int *kind) {
    const dem_world *w = &now.s.world;
    if (!room_for(&corners, &corner_room, CORNER * (n_corners + 3 * (ptrdiff_t)s->triangles))) return;
    for (int k = 0; k < 3 * s->triangles; k++) {
        const int v = s->triangle[k], owner = s->wall[s->triangle[k - k % 3]];
        float *c = corners + CORNER * n_corners++;
        for (int axis = 0; axis < 3; axis++) c[axis] = (float)s->vertex[3 * v + axis];
        c[3] = !kind                          ? number_of(colour_of(w, &look, owner))
               : kind[owner] == PICTURE_GLASS ? -1.0f
                                              : number_of(picture_steel());
    }
}

/* Triangles of walls and polyhedra; the number of their corners is page_corner_count. */
const float *EXPORT(page_corners)(void) {
    const dem_world *w = &now.s.world;
    dem_io_surface surface;
    dem_vec middle = dem_vec3(0, 0, 0);
    int kind[DEM_WALLS_MAX], n = 0;
    n_corners = 0;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        const dem_vec x = dem_position(w, i);
        middle.x += x.x, middle.y += x.y, middle.z += x.z, n++;
    }
    if (n) middle = dem_vec3(middle.x / n, middle.y / n, middle.z / n);
    if (dem_io_surface_of(w, &surface) == DEM_OK) {
        for (int k = 0; k < w->walls; k++) kind[k] = is_glass(&w->wall[k], &surface, k, middle);
        put_corners(&surface, kind);
        dem_io_free_surface(&surface);
    }
    if (dem_get_shape(w, 0) && dem_io_polyhedra_of(w, &surface) == DEM_OK) {
        put_corners(&surface, NULL);
        dem_io_free_surface(&surface);
    }
    return corners;
}
int EXPORT(page_corner_count)(void) { return n_corners; }

/* ---- names ---- */

int EXPORT(page_groups)(void) { return now.s.groups; }
const char *EXPORT(page_group)(int group) { return now.s.group[group].name; }
double EXPORT(page_group_colour)(int group) { return (double)number_of(picture_class(group)); }
double EXPORT(page_top_speed)(void) { return look.speed; } /* [m/s]; 0: coloured by groups */
double EXPORT(page_speed_colour)(double share) { return (double)number_of(picture_scale(share)); }
double EXPORT(page_view)(int axis) { return now.def.output.view[axis]; } /* from the eye to the picture */

/* Templates: their names, and the lines of one joined; NULL after the last. */
const char *EXPORT(page_template_name)(int k) { return templates[k].name; }
const char *EXPORT(page_template)(int k) {
    static char text[16384];
    text[0] = '\0';
    for (const char *const *line = templates[k].line; *line; line++)
        strncat(text, *line, sizeof text - strlen(text) - 1);
    return text;
}
