/* Permeability of a cloth, a rock or a bed from its image or its surface, by filtration.h, in three directions.

   permeability FILE    a voxel image: raw bytes (--size NX,NY,NZ), .tif of many pages, ParaView .vti; or a closed
                        surface: .stl
   Without FILE: a plain weave, 16 voxels a pitch.

   1. The table: permeability along x, y and z, its error from two resolutions, porosity.
   2. flow_x.svg, flow_y.svg, flow_z.svg: speed in the middle section; flow_x.vti ...: velocity and pressure,
      for ParaView. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "dem.h"
#include "filtration.h"
#include "input.h"
#include "mesh_solid.h"
#include "voxel_file.h"

/* The command line. */
typedef struct settings {
    const char *file, *size_text, *array;
    double voxel_um, unit_um, threshold, box_um[3], tolerance;
    int type, skip, refine, nodes, sides;
    bool below, one, threshold_given;
    double size[3];
    const char *box_text;
} settings;

enum { AROUND_REPEATS, AROUND_WALLS };

/* What the liquid flows through. */
typedef struct geometry {
    bool is_mesh;
    unsigned char *solid; /* of the image */
    filtration_image image;
    dem_mesh mesh;
    mesh_solid surface;
    double box[3];     /* [m] */
    double spacing[2]; /* of nodes: fine, coarse; 0: there is no coarse one [m] */
    bool same_cubes;   /* 1: of an image, more than one node a voxel on the fine grid, at least one on the coarse one */
    double porosity;   /* of the image; NaN for a surface */
} geometry;

static void need(const void *memory) {
    if (!memory) exit((common_fail("out of memory"), common_exit_status()));
}

static void refuse_file(const program *self, const settings *s, const char *reason) {
    char text[700];
    snprintf(text, sizeof text, "a voxel image (raw with --size, .tif, .vti) or a closed surface (.stl); this one: %s",
             reason);
    program_refuse(self, "file", s->file, text);
}

static bool ends_with(const char *name, const char *end) {
    const size_t n = strlen(name), m = strlen(end);
    if (n < m) return false;
    for (size_t k = 0; k < m; k++) {
        const char c = name[n - m + k];
        if ((c >= 'A' && c <= 'Z' ? c + 'a' - 'A' : c) != end[k]) return false;
    }
    return true;
}

/* "a,b,c", each above 0 */
static bool three_numbers(const char *text, double out[3]) {
    char rest;
    return sscanf(text, "%lf,%lf,%lf%c", &out[0], &out[1], &out[2], &rest) == 3 && out[0] > 0.0 && out[1] > 0.0 &&
           out[2] > 0.0 && isfinite(out[0] + out[1] + out[2]);
}

/* ---- the solid ---- */

static void set_image(geometry *g, const settings *s, const int n[3], double edge) {
    const size_t cubes = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    size_t full = 0;
    memset(&g->image, 0, sizeof g->image);
    bool even = true;
    for (int k = 0; k < 3; k++) {
        g->image.n[k] = n[k], g->image.periodic[k] = 1, g->box[k] = n[k] * edge;
        even = even && n[k] % 2 == 0;
    }
    for (size_t i = 0; i < cubes; i++) full += g->solid[i] != 0;
    g->image.edge = edge, g->image.reach = 2, g->image.solid = g->solid;
    g->porosity = 1.0 - (double)full / (double)cubes;
    const int fine = s->refine, coarse = fine / 2;
    g->same_cubes = coarse > 0;
    g->spacing[0] = edge / fine;
    g->spacing[1] = coarse > 0 ? edge / coarse : even ? 2.0 * edge : 0.0;
}

/* A plain weave whose wires are half of the pitch: two pitches wide, so that it repeats, and as much liquid
   above and below. */
static void draw_weave(geometry *g, const settings *s, bool quick) {
    const int pitch = quick ? 4 : 16, n[3] = {2 * pitch, 2 * pitch, 2 * pitch};
    filtration_cloth cloth;
    const double edge = 100e-6 / pitch;
    filtration_cloth_make(&cloth, 50e-6, 50e-6, FILTRATION_PLAIN_WEAVE, 100e-6);
    g->solid = malloc((size_t)n[0] * (size_t)n[1] * (size_t)n[2]);
    need(g->solid);
    unsigned char *to = g->solid;
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++) {
                const double point[3] = {(x + 0.5) * edge, (y + 0.5) * edge, (z + 0.5) * edge};
                *to++ = filtration_cloth_distance(&cloth, point) < 0.0;
            }
    set_image(g, s, n, edge);
}

static void read_image(geometry *g, const program *self, const settings *s, const char *bytes, size_t size) {
    voxel_image m;
    char message[400];
    int status;
    memset(&m, 0, sizeof m);
    if (ends_with(s->file, ".tif") || ends_with(s->file, ".tiff"))
        status = voxel_tif((const unsigned char *)bytes, size, &m, message, sizeof message);
    else if (ends_with(s->file, ".vti")) status = voxel_vti(bytes, size, s->array, &m, message, sizeof message);
    else {
        if (!s->size_text) program_refuse(self, "size", NULL, "NX,NY,NZ of the raw file, x fastest");
        status = voxel_raw((const unsigned char *)bytes, size, s->size, s->type, (size_t)s->skip, &m, message,
                           sizeof message);
    }
    if (status != 0) refuse_file(self, s, message);
    const size_t cubes = voxel_count(&m);
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (size_t i = 0; i < cubes; i++) {
        const double value = (double)m.value[i];
        if (!isfinite(value)) refuse_file(self, s, "a value is not a number");
        low = fmin(low, value), high = fmax(high, value);
    }
    const double threshold = s->threshold_given ? s->threshold : 0.5 * (low + high);
    g->solid = malloc(cubes);
    need(g->solid);
    for (size_t i = 0; i < cubes; i++)
        g->solid[i] = (high > low || s->threshold_given) && ((double)m.value[i] >= threshold) != s->below;
    free(m.value);
    const double edge = s->voxel_um > 0.0 ? 1e-6 * s->voxel_um : m.edge > 0.0 ? m.edge : 1e-6;
    set_image(g, s, m.n, edge);
    common_print("%s: %d x %d x %d voxels of %.4g um, values %g to %g, solid %s %g: porosity %.4f\n", s->file, m.n[0],
                 m.n[1], m.n[2], 1e6 * edge, low, high, s->below ? "below" : "from", threshold, g->porosity);
}

static void read_surface(geometry *g, const program *self, const settings *s, const char *bytes, size_t size) {
    dem_stl_report found;
    char message[300];
    double low[3], high[3], longest = 0.0;
    if (dem_read_stl(bytes, size, 1e-6 * s->unit_um, 0.0, NULL, &g->mesh, &found) != DEM_OK)
        refuse_file(self, s, "no STL file, or no triangle in it");
    if (found.open_edges + found.nonmanifold > 0 || found.missing > 0) {
        snprintf(message, sizeof message,
                 "the surface is not closed: %td edges of one triangle only, %td of more than two", found.open_edges,
                 found.nonmanifold);
        refuse_file(self, s, message);
    }
    low[0] = found.low.x, low[1] = found.low.y, low[2] = found.low.z;
    high[0] = found.high.x, high[1] = found.high.y, high[2] = found.high.z;
    for (int k = 0; k < 3; k++) {
        g->box[k] = s->box_text ? 1e-6 * s->box_um[k] : high[k] - low[k];
        if (!s->box_text) /* the surface from the corner of its own box */
            for (ptrdiff_t v = 0; v < g->mesh.vertices; v++) g->mesh.vertex[3 * v + k] -= low[k];
        longest = fmax(longest, g->box[k]);
    }
    const int repeats[3] = {1, 1, 1};
    g->is_mesh = true, g->porosity = (double)NAN;
    g->spacing[0] = longest / s->nodes, g->spacing[1] = s->nodes >= 12 ? longest / (2 * s->nodes / 3) : 0.0;
    if (mesh_solid_make(&g->surface, &g->mesh, g->box, repeats, 1e-3 * g->spacing[0]) != 0) need(NULL);
    common_print("%s: %td triangles, volume %.4g m3, box %.4g x %.4g x %.4g um\n", s->file, g->mesh.triangles,
                 fabs(found.volume), 1e6 * g->box[0], 1e6 * g->box[1], 1e6 * g->box[2]);
}

static geometry make_geometry(const program *self, const settings *s) {
    geometry g;
    memset(&g, 0, sizeof g);
    if (!s->file) {
        draw_weave(&g, s, self->quick);
        return g;
    }
    char message[400];
    size_t size;
    char *bytes = input_read_most(s->file, 4000, &size, message, sizeof message);
    if (!bytes) refuse_file(self, s, message);
    if (ends_with(s->file, ".stl")) read_surface(&g, self, s, bytes, size);
    else read_image(&g, self, s, bytes, size);
    free(bytes);
    return g;
}

/* ---- the flow ---- */

typedef struct found {
    filtration_permeability_result fine, coarse;
    double k, error; /* [m2]; error NaN: one resolution only */
    bool closed;     /* no way through */
} found;

/* Is there a way through the fluid nodes along an axis, from the box's first slab to its last? */
static bool is_open(const filtration_fluid *f, int axis) {
    const int *n = f->def.nodes;
    const size_t nodes = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    int32_t *owner = malloc(nodes * sizeof *owner), *stack = malloc(nodes * sizeof *stack);
    size_t depth = 0;
    bool through = false;
    need(owner), need(stack);
    filtration_fluid_fields(f, NULL, NULL, owner);
    const int step[3] = {1, n[0], n[0] * n[1]};
    for (size_t i = 0; i < nodes; i++)
        if (owner[i] == -1 && (int)(i / (size_t)step[axis]) % n[axis] == 0) owner[i] = 1, stack[depth++] = (int32_t)i;
    while (depth > 0 && !through) {
        const int i = stack[--depth];
        for (int side = 0; side < 6; side++) {
            const int a = side / 2, up = side % 2, at = i / step[a] % n[a];
            int to = at + (up ? 1 : -1);
            if (a == axis && (to < 0 || to >= n[a])) continue;
            to = (to + n[a]) % n[a];
            const int j = i + (to - at) * step[a];
            if (owner[j] != -1) continue;
            owner[j] = 1, stack[depth++] = j;
            through = through || (a == axis && to == n[a] - 1);
        }
    }
    free(owner), free(stack);
    return through || n[axis] == 1;
}

static void draw_section(const program *self, const filtration_fluid *f, const float *velocity, const int32_t *owner,
                         int axis) {
    const int *n = f->def.nodes, across = axis == 2 ? 0 : 2,
              along = axis; /* the plane of the flow and z, or of z and x */
    const int middle = 3 - across - along, columns = n[along], rows = n[across];
    double *speed = malloc((size_t)columns * (size_t)rows * sizeof *speed);
    char name[40];
    need(speed);
    for (int r = 0; r < rows; r++)
        for (int c = 0; c < columns; c++) {
            int at[3];
            at[along] = c, at[across] = r, at[middle] = n[middle] / 2;
            const size_t i = ((size_t)at[2] * (size_t)n[1] + (size_t)at[1]) * (size_t)n[0] + (size_t)at[0];
            const float *v = &velocity[3 * i];
            speed[r * columns + c] =
                owner[i] == -1 ? sqrt((double)(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])) : (double)NAN;
        }
    double mean[3];
    filtration_fluid_mean_velocity(f, mean);
    for (int i = 0; i < rows * columns; i++) speed[i] /= fabs(mean[axis]) > 0.0 ? fabs(mean[axis]) : 1.0;
    snprintf(name, sizeof name, "flow_%c.svg", "xyz"[axis]);
    char x[20], y[20];
    snprintf(x, sizeof x, "%c [µm]", "xyz"[along]), snprintf(y, sizeof y, "%c [µm]", "xyz"[across]);
    riddle_plot *figure = riddle_plot_new("Flow in the middle section", 1, 1);
    riddle_plot_panel(figure, 0, 0, x, y);
    riddle_plot_heat(figure, "speed over the mean of the box [-]", speed, columns, rows, 0.0,
                     1e6 * columns * f->def.voxel, 0.0, 1e6 * rows * f->def.voxel);
    riddle_plot_write(figure, self->out, name);
    free(speed);
}

static void write_flow(const program *self, const filtration_fluid *f, int axis) {
    const int *n = f->def.nodes;
    const size_t nodes = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    const double origin[3] = {0.0, 0.0, 0.0}, spacing[3] = {f->def.voxel, f->def.voxel, f->def.voxel};
    float *velocity = malloc(7 * nodes * sizeof *velocity), *part = velocity + 4 * nodes;
    int32_t *owner = malloc(nodes * sizeof *owner);
    char name[40];
    need(velocity), need(owner);
    filtration_fluid_fields(f, velocity, velocity + 3 * nodes, owner);
    for (size_t i = 0; i < nodes; i++)
        for (int k = 0; k < 3; k++) part[(size_t)k * nodes + i] = velocity[3 * i + (size_t)k];
    const riddle_io_array arrays[] = {
        riddle_io_scalar_float("velocity_x_m_per_s", part), riddle_io_scalar_float("velocity_y_m_per_s", part + nodes),
        riddle_io_scalar_float("velocity_z_m_per_s", part + 2 * nodes),
        riddle_io_scalar_float("pressure_pa", velocity + 3 * nodes), riddle_io_ints("solid", (const int *)owner)};
    snprintf(name, sizeof name, "flow_%c.vti", "xyz"[axis]);
    riddle_io_cells(self->out, name, n, origin, spacing, arrays, 5);
    draw_section(self, f, velocity, owner, axis);
    free(velocity), free(owner);
}

/* One run. The drop of pressure keeps the flow creeping: if the box were empty, its Reynolds number would
   be about 0.01. */
static filtration_status run(const program *self, const settings *s, const geometry *g, double spacing, int axis,
                             bool shown, found *f, filtration_permeability_result *result) {
    filtration_fluid_def def = filtration_fluid_default_def();
    filtration_fluid fluid;
    double widest = 0.0;
    for (int k = 0; k < 3; k++) {
        def.nodes[k] = (int)ceil(g->box[k] / spacing - 1e-6);
        if (def.nodes[k] < 1) def.nodes[k] = 1;
        widest = fmax(widest, g->box[k]);
        if (s->sides == AROUND_WALLS && k != axis) def.face[2 * k] = def.face[2 * k + 1] = FILTRATION_WALL;
    }
    def.voxel = spacing, def.tau = 2.0, def.threads = self->threads;
    def.solid = g->is_mesh ? mesh_as_solid(&g->surface) : filtration_image_solid(&g->image);
    program_need_memory(self, "refine", 170.0 * def.nodes[0] * def.nodes[1] * def.nodes[2]);
    filtration_status status = filtration_fluid_init(&fluid, &def);
    if (status != FILTRATION_OK) return status;
    const double nu = def.viscosity / def.density,
                 drop = 0.1 * def.density * nu * nu / (widest * widest * widest) * g->box[axis];
    f->closed = !is_open(&fluid, axis);
    memset(result, 0, sizeof *result);
    result->porosity = filtration_fluid_porosity(&fluid);
    if (!f->closed) status = filtration_fluid_permeability(&fluid, NULL, axis, drop, s->tolerance, 2000000, result);
    if (shown && status == FILTRATION_OK) write_flow(self, &fluid, axis);
    filtration_fluid_free(&fluid);
    return status;
}

/* Both resolutions. Where both have the same cubes (--refine 2 and more) the permeability goes to that of no spacing in
   proportion to the spacing: that is the result, and the way to it its error. Else the fine grid's is the result, and
   the difference its error: how a surface lies between the nodes changes it as much. */
static void find(const program *self, const settings *s, const geometry *g, int axis, found *f) {
    memset(f, 0, sizeof *f);
    filtration_status status = run(self, s, g, g->spacing[0], axis, true, f, &f->fine);
    f->k = f->closed ? 0.0 : f->fine.permeability, f->error = (double)NAN;
    if (status == FILTRATION_OK && g->spacing[1] > 0.0 && !f->closed && !s->one) {
        found coarse;
        status = run(self, s, g, g->spacing[1], axis, false, &coarse, &f->coarse);
        if (status == FILTRATION_OK && !coarse.closed) {
            const double gap = f->fine.permeability - f->coarse.permeability;
            const double further = g->same_cubes ? gap / (g->spacing[1] / g->spacing[0] - 1.0) : 0.0;
            f->k = f->fine.permeability + further, f->error = g->same_cubes ? fabs(further) : fabs(gap);
        }
    }
    if (status != FILTRATION_OK)
        exit((common_fail("flow along %c: %s", "xyz"[axis], filtration_status_text(status)), common_exit_status()));
}

static void report(const program *self, const settings *s, const geometry *g, const found f[3]) {
    json *j = json_open(self->json);
    riddle_io_table t =
        riddle_io_table_begin("along|permeability [m2]|error|[darcy]|fine grid|coarse grid|resistance [1/m]");
    json_string(j, "source", s->file ? s->file : "plain weave, wires half of the pitch");
    results_values(j, {"porosity_image", g->porosity}, {"porosity", f[0].fine.porosity}, {"spacing_m", g->spacing[0]},
                   {"coarse_spacing_m", g->spacing[1]});
    for (int a = 0; a < 3; a++) {
        char key[40];
        const double length = g->box[a];
        riddle_io_table_cell(&t, "%c", "xyz"[a]);
        riddle_io_table_cell(&t, "%.4g", f[a].k);
        riddle_io_table_cell(&t, isfinite(f[a].error) ? "%.1f %%" : "none", 100.0 * f[a].error / f[a].k);
        riddle_io_table_cell(&t, "%.4g", f[a].k / 9.869233e-13);
        riddle_io_table_cell(&t, "%.4g", f[a].fine.permeability);
        riddle_io_table_cell(&t, "%.4g", f[a].coarse.permeability);
        riddle_io_table_cell(&t, f[a].k > 0.0 ? "%.4g" : "closed", length / f[a].k);
        snprintf(key, sizeof key, "along_%c", "xyz"[a]);
        json_object_begin(j, key);
        results_values(j, {"permeability_m2", f[a].k}, {"error_m2", f[a].error}, {"fine_m2", f[a].fine.permeability},
                       {"coarse_m2", f[a].coarse.permeability}, {"closed", f[a].closed},
                       {"steps", (double)f[a].fine.steps});
        json_object_end(j);
    }
    common_print("Nodes %.4g um apart, beside %.4g um; porosity of the fine grid %.4f\n\n", 1e6 * g->spacing[0],
                 1e6 * g->spacing[1], f[0].fine.porosity);
    table_end(&t);
    for (int a = 0; a < 3; a++)
        if (f[a].closed) common_print("There is no way through along %c.\n", "xyz"[a]);
    if (!(g->spacing[1] > 0.0))
        common_print("No error: the coarser grid needs even numbers of voxels, or --refine 2.\n");
    json_program(j, self);
    json_close(j);
}

int main(int argc, char **argv) {
    settings s;
    memset(&s, 0, sizeof s);
    s.unit_um = 1000.0, s.nodes = 48, s.tolerance = 1e-5, s.refine = 1;
    option options[] = {
        option_string("file", "FILE", &s.file, "image or surface; also as the first argument"),
        option_string("size", "NX,NY,NZ", &s.size_text, "voxels of a raw file, x fastest"),
        option_choice("type", &s.type, "u8|u16|f32", "of the values of a raw file, little end first"),
        option_int("skip", "BYTES", &s.skip, 0, 2000000000, "bytes of a raw file before its values"),
        option_string("array", "NAME", &s.array, "of a .vti file; default: its first"),
        option_positive("voxel-um", "A", &s.voxel_um, 1e9,
                        "edge of a voxel [um]; default: what a .vti says [m], else 1"),
        option_double("threshold", "G", &s.threshold, -1e30, 1e30,
                      "value from which on a voxel is solid; default: middle of least and largest"),
        option_flag("solid-below", &s.below, "voxels below the threshold are solid"),
        option_int("refine", "N", &s.refine, 1, 16,
                   "nodes along a voxel: more resolve the corners of its cubes, which a smooth body does not have"),
        option_positive("unit-um", "L", &s.unit_um, 1e9, "unit of an .stl file [um]"),
        option_string("box-um", "X,Y,Z", &s.box_text,
                      "box from 0 that repeats, around a surface [um]; default: its own"),
        option_int("nodes", "N", &s.nodes, 4, 2000, "along the longest edge of the box of a surface"),
        option_choice("sides", &s.sides, "repeat|wall", "of the box beside the flow"),
        option_positive("tolerance", "E", &s.tolerance, 0.1, "change of the flow at which it is steady [-]"),
        option_flag("one-grid", &s.one, "no second resolution, and no error"),
    };
    const int n = (int)(sizeof options / sizeof *options);
    char *given[200] = {NULL}, first[] = "--file";
    int count = 0; /* FILE as the first argument is --file FILE */
    for (int i = 0; i < argc && count < 197; i++) {
        if (i == 1 && argv[i][0] != '-') given[count++] = first;
        given[count++] = argv[i];
    }
    program self =
        program_start("permeability", "Permeability of a cloth, a rock or a bed from its image or its surface.",
                      options, n, count, given);
    for (int i = 0; i < n; i++)
        if (options[i].given && strcmp(options[i].name, "threshold") == 0) s.threshold_given = true;
    if (s.size_text && !three_numbers(s.size_text, s.size))
        program_refuse(&self, "size", s.size_text, "NX,NY,NZ, three numbers above 0");
    if (s.box_text && !three_numbers(s.box_text, s.box_um))
        program_refuse(&self, "box-um", s.box_text, "X,Y,Z, three numbers above 0");
    geometry g = make_geometry(&self, &s);
    found f[3];
    for (int axis = 0; axis < 3; axis++) find(&self, &s, &g, axis, &f[axis]);
    report(&self, &s, &g, f);
    free(g.solid), mesh_solid_free(&g.surface), dem_free_mesh(&g.mesh);
    return common_exit_status();
}
