#define _POSIX_C_SOURCE 200809L
#include "vtk.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"

static vtk_array view(const char *name, int components) {
    vtk_array a = {name, components, 1, {NULL, NULL, NULL}, NULL, NULL};
    return a;
}

vtk_array vtk_scalar(const char *name, const double *values) {
    vtk_array a = view(name, 1);
    a.data[0] = values;
    return a;
}

vtk_array vtk_scalar_float(const char *name, const float *values) {
    vtk_array a = view(name, 1);
    a.floats = values;
    return a;
}

vtk_array vtk_ints(const char *name, const int *values) {
    vtk_array a = view(name, 1);
    a.ints = values;
    return a;
}

vtk_array vtk_vector_stride(const char *name, const double *xyz, int stride) {
    vtk_array a = view(name, 3);
    for (int k = 0; k < 3; k++) a.data[k] = xyz ? xyz + k : NULL;
    a.stride = stride;
    return a;
}

vtk_array vtk_vector(const char *name, const double *xyz) { return vtk_vector_stride(name, xyz, 3); }

vtk_array vtk_vector3(const char *name, const double *x, const double *y, const double *z) {
    vtk_array a = view(name, 3);
    a.data[0] = x;
    a.data[1] = y;
    a.data[2] = z;
    return a;
}

/* ---- bytes, little-endian on any machine, through one buffer ---- */

typedef struct {
    output *file;
    size_t used;
    unsigned char bytes[65536];
} stream;

static void put(stream *s, uint64_t value, int bytes) {
    if (s->used + 8 > sizeof s->bytes) {
        output_write(s->file, s->bytes, s->used);
        s->used = 0;
    }
    for (int i = 0; i < bytes; i++) s->bytes[s->used++] = (unsigned char)(value >> (8 * i) & 0xFF);
}

static void put_float(stream *s, double value) {
    float narrow = (float)value;
    uint32_t bits;
    memcpy(&bits, &narrow, sizeof bits);
    put(s, bits, 4);
}

static uint64_t array_bytes(const vtk_array *a, int n) { return 4 * (uint64_t)a->components * (uint64_t)n; }

static void put_array(stream *s, const vtk_array *a, int n) {
    put(s, array_bytes(a, n), 8);
    for (int i = 0; i < n; i++) {
        if (a->ints) put(s, (uint32_t)a->ints[i], 4);
        else if (a->floats) put_float(s, (double)a->floats[i]);
        else
            for (int k = 0; k < a->components; k++) put_float(s, a->data[k][(size_t)i * (size_t)a->stride]);
    }
}

static void put_ints(stream *s, const int *values, int n) {
    put(s, 4 * (uint64_t)n, 8);
    for (int i = 0; i < n; i++) put(s, (uint32_t)(values ? values[i] : i), 4);
}

/* ---- the XML around them; *offset counts into the appended block ---- */

static void write_escaped(output *file, const char *text) {
    for (; *text; text++) {
        if (*text == '&') output_print(file, "&amp;");
        else if (*text == '<') output_print(file, "&lt;");
        else if (*text == '"') output_print(file, "&quot;");
        else output_write(file, text, 1);
    }
}

static void describe(output *file, const vtk_array *a, int n, uint64_t *offset) {
    output_print(file, "<DataArray type=\"%s\" Name=\"", a->ints ? "Int32" : "Float32");
    write_escaped(file, a->name);
    output_print(file, "\" NumberOfComponents=\"%d\" format=\"appended\" offset=\"%llu\"/>\n", a->components, (unsigned long long)*offset);
    *offset += 8 + array_bytes(a, n);
}

static void describe_ints(output *file, const char *name, int n, uint64_t *offset) {
    output_print(file, "<DataArray type=\"Int32\" Name=\"%s\" format=\"appended\" offset=\"%llu\"/>\n", name, (unsigned long long)*offset);
    *offset += 8 + 4 * (uint64_t)n;
}

static void head(output *file, const char *type) {
    output_print(
        file, "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n", type);
}

static stream *begin_appended(output *file) {
    stream *s = malloc(sizeof *s);
    if (!s) {
        common_fail("out of memory");
        return NULL;
    }
    s->file = file;
    s->used = 0;
    output_print(file, "<AppendedData encoding=\"raw\">\n_");
    return s;
}

static int end_appended(stream *s) {
    output *file = s->file;
    output_write(file, s->bytes, s->used);
    free(s);
    output_print(file, "\n</AppendedData>\n</VTKFile>\n");
    return output_close(file);
}

static int polydata(const char *folder, const char *name, const char *cell_kind, int n, vtk_array position, int n_cells, const int *ends,
                    const int *corners, const vtk_array *arrays, int n_arrays) {
    bool vertices = strcmp(cell_kind, "Verts") == 0;
    int n_corners = vertices ? n : n_cells > 0 ? ends[n_cells - 1] : 0;
    output *file = output_open(folder, name);
    if (!file) return -1;
    uint64_t offset = 0;
    head(file, "PolyData");
    output_print(
        file,
        "<PolyData>\n<Piece NumberOfPoints=\"%d\" NumberOfVerts=\"%d\" NumberOfLines=\"%d\" NumberOfStrips=\"0\" NumberOfPolys=\"%d\">\n",
        n, vertices ? n : 0, strcmp(cell_kind, "Lines") == 0 ? n_cells : 0, strcmp(cell_kind, "Polys") == 0 ? n_cells : 0);
    output_print(file, "<PointData>\n");
    for (int i = 0; i < n_arrays; i++) describe(file, &arrays[i], n, &offset);
    output_print(file, "</PointData>\n<Points>\n");
    describe(file, &position, n, &offset);
    output_print(file, "</Points>\n<%s>\n", cell_kind);
    describe_ints(file, "connectivity", n_corners, &offset);
    describe_ints(file, "offsets", n_cells, &offset);
    output_print(file, "</%s>\n</Piece>\n</PolyData>\n", cell_kind);
    stream *s = begin_appended(file);
    if (!s) {
        output_discard(file);
        return -1;
    }
    for (int i = 0; i < n_arrays; i++) put_array(s, &arrays[i], n);
    put_array(s, &position, n);
    put_ints(s, vertices ? NULL : corners, n_corners);
    if (vertices) {
        put(s, 4 * (uint64_t)n, 8);
        for (int i = 0; i < n; i++) put(s, (uint32_t)(i + 1), 4);
    } else {
        put_ints(s, ends, n_cells);
    }
    return end_appended(s);
}

int vtp_points(const char *folder, const char *name, int n, vtk_array position, const vtk_array *arrays, int n_arrays) {
    return polydata(folder, name, "Verts", n, position, n, NULL, NULL, arrays, n_arrays);
}

int vtp_lines(const char *folder, const char *name, int n_points, vtk_array position, int n_cells, const int *ends, const int *corners,
              const vtk_array *arrays, int n_arrays) {
    return polydata(folder, name, "Lines", n_points, position, n_cells, ends, corners, arrays, n_arrays);
}

int vtp_polygons(const char *folder, const char *name, int n_points, vtk_array position, int n_cells, const int *ends, const int *corners,
                 const vtk_array *arrays, int n_arrays) {
    return polydata(folder, name, "Polys", n_points, position, n_cells, ends, corners, arrays, n_arrays);
}

int vti_cells(const char *folder, const char *name, const int size[3], const double origin[3], const double spacing[3],
              const vtk_array *arrays, int n_arrays) {
    double cells = (double)size[0] * size[1] * size[2];
    if (!(size[0] > 0 && size[1] > 0 && size[2] > 0 && cells < 2147483647.0))
        return common_fail("%s: a grid of %d x %d x %d cells cannot be written", name, size[0], size[1], size[2]);
    int n = size[0] * size[1] * size[2];
    output *file = output_open(folder, name);
    if (!file) return -1;
    uint64_t offset = 0;
    head(file, "ImageData");
    output_print(file, "<ImageData WholeExtent=\"0 %d 0 %d 0 %d\" Origin=\"%.9g %.9g %.9g\" Spacing=\"%.9g %.9g %.9g\">\n", size[0],
                 size[1], size[2], origin[0], origin[1], origin[2], spacing[0], spacing[1], spacing[2]);
    output_print(file, "<Piece Extent=\"0 %d 0 %d 0 %d\">\n<CellData>\n", size[0], size[1], size[2]);
    for (int i = 0; i < n_arrays; i++) describe(file, &arrays[i], n, &offset);
    output_print(file, "</CellData>\n</Piece>\n</ImageData>\n");
    stream *s = begin_appended(file);
    if (!s) {
        output_discard(file);
        return -1;
    }
    for (int i = 0; i < n_arrays; i++) put_array(s, &arrays[i], n);
    return end_appended(s);
}

/* ---- time series ---- */

struct pvd {
    char *folder, *stem;
    double *times;
    char (*extensions)[8];
    int n, capacity;
    char current[400];
};

static char *copy(const char *text, size_t length) {
    char *c = malloc(length + 1);
    if (!c) return NULL;
    memcpy(c, text, length);
    c[length] = '\0';
    return c;
}

static void frame_name(const pvd *series, int i, char *text, size_t size) {
    snprintf(text, size, "%s_%04d.%s", series->stem, i, series->extensions[i]);
}

static int write_index(const pvd *series) {
    char name[400];
    snprintf(name, sizeof name, "%s.pvd", series->stem);
    output *file = output_open(series->folder, name);
    if (!file) return -1;
    output_print(file,
                 "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n");
    for (int i = 0; i < series->n; i++) {
        frame_name(series, i, name, sizeof name);
        output_print(file, "<DataSet timestep=\"%.9g\" part=\"0\" file=\"", series->times[i]);
        write_escaped(file, name);
        output_print(file, "\"/>\n");
    }
    output_print(file, "</Collection>\n</VTKFile>\n");
    return output_close(file);
}

pvd *pvd_open(const char *folder, const char *name) {
    size_t length = strlen(name);
    if (length > 4 && strcmp(name + length - 4, ".pvd") == 0) length -= 4;
    pvd *series = calloc(1, sizeof *series);
    if (series) {
        series->folder = copy(folder, strlen(folder));
        series->stem = copy(name, length);
    }
    if (!series || !series->folder || !series->stem) {
        common_fail("%s: out of memory", name);
        if (series) {
            free(series->folder);
            free(series->stem);
            free(series);
        }
        return NULL;
    }
    return series;
}

const char *pvd_name_as(pvd *series, double time, const char *extension) {
    if (!series) return "lost.vtp";
    if (series->n > 0) write_index(series);
    if (series->n == series->capacity) {
        int capacity = 2 * series->capacity + 64;
        double *times = realloc(series->times, (size_t)capacity * sizeof *times);
        if (times) series->times = times;
        char(*extensions)[8] = realloc(series->extensions, (size_t)capacity * sizeof *extensions);
        if (extensions) series->extensions = extensions;
        if (!times || !extensions) {
            common_fail("%s.pvd: out of memory", series->stem);
            return "lost.vtp";
        }
        series->capacity = capacity;
    }
    series->times[series->n] = time;
    snprintf(series->extensions[series->n], sizeof *series->extensions, "%s", extension);
    frame_name(series, series->n++, series->current, sizeof series->current);
    return series->current;
}

const char *pvd_name(pvd *series, double time) { return pvd_name_as(series, time, "vtp"); }

int pvd_close(pvd *series) {
    if (!series) return -1;
    int status = write_index(series);
    free(series->folder);
    free(series->stem);
    free(series->times);
    free(series->extensions);
    free(series);
    return status;
}
