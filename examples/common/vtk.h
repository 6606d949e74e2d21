/* vtk.h: particles, surfaces and images for ParaView: .vtp, .vti (binary, little-endian, float32, int32), .pvd index of a time series.

       pvd *series = pvd_open(self.out, "particles.pvd");
       for each frame {
           vtk_array arrays[] = {vtk_scalar("radius", radius), vtk_vector3("velocity", vx, vy, vz), vtk_ints("class", klass)};
           vtp_points(self.out, pvd_name(series, time), n, vtk_vector3("position", x, y, z), arrays, 3);
       }
       pvd_close(series); */
#ifndef RIDDLE_VTK_H
#define RIDDLE_VTK_H

/* Views of the caller's arrays, nothing is copied before writing. */
typedef struct vtk_array {
    const char *name; /* with the unit where there is one: "velocity_m_s" */
    int components;   /* 1 or 3 */
    int stride;       /* between neighbours in data[k] */
    const double *data[3];
    const float *floats; /* one of data, floats, ints is not NULL */
    const int *ints;
} vtk_array;

vtk_array vtk_scalar(const char *name, const double *values);                               /* [n] */
vtk_array vtk_scalar_float(const char *name, const float *values);                          /* [n] */
vtk_array vtk_ints(const char *name, const int *values);                                    /* [n] */
vtk_array vtk_vector(const char *name, const double *xyz);                                  /* [n][3] */
vtk_array vtk_vector3(const char *name, const double *x, const double *y, const double *z); /* three of [n] */
vtk_array vtk_vector_stride(const char *name, const double *xyz, int stride); /* xyz + i * stride [doubles]: fields of a struct */

/* n points with their arrays, one vertex each (Glyph or Point Gaussian in ParaView). 0, or -1 after one line on stderr. */
int vtp_points(const char *folder, const char *name, int n, vtk_array position, const vtk_array *arrays, int n_arrays);

/* Lines or polygons: cell c joins corners[ends[c-1]] .. corners[ends[c]-1] (0-based points; ends[-1] is 0). Arrays belong to the points. */
int vtp_lines(const char *folder, const char *name, int n_points, vtk_array position, int n_cells, const int *ends, const int *corners,
              const vtk_array *arrays, int n_arrays);
int vtp_polygons(const char *folder, const char *name, int n_points, vtk_array position, int n_cells, const int *ends, const int *corners,
                 const vtk_array *arrays, int n_arrays);

/* A regular grid of size[0] x size[1] x size[2] cells, first index fastest; origin and spacing [m]. Arrays belong to the cells. */
int vti_cells(const char *folder, const char *name, const int size[3], const double origin[3], const double spacing[3],
              const vtk_array *arrays, int n_arrays);

/* The index of a time series: particles.pvd lists particles_0000.vtp, ... and is rewritten whole at each frame. */
typedef struct pvd pvd;
pvd *pvd_open(const char *folder, const char *name);
const char *pvd_name(pvd *series, double time); /* the next frame's file name (no folder), listed in the index from the next call on */
const char *pvd_name_as(pvd *series, double time, const char *extension); /* "vti" instead of "vtp" */
int pvd_close(pvd *series);

#endif
