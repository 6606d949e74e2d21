/* io.h: riddle_io.h under the short names that the programs here use, and with their way of telling an error: one line on stderr, and
   the run is marked as failed (progress.h). A program of your own needs riddle_io.h alone. */
#ifndef RIDDLE_COMMON_IO_H
#define RIDDLE_COMMON_IO_H

#ifndef RIDDLE_IO_API
#define RIDDLE_IO_API extern /* the one copy of the bodies is in io.c */
#endif
#include "riddle_io.h"

#include "progress.h"

#define output riddle_io_file
#define output_open riddle_io_open
#define output_print riddle_io_print
#define output_write riddle_io_write
#define output_close riddle_io_close
#define output_discard riddle_io_discard
#define output_make_folder riddle_io_make_folder
#define output_can_write riddle_io_can_write
#define output_path riddle_io_path
/* A file or folder that comes with the repository: name if it exists from where the program is run, else name in the repository's root. */
const char *output_find(char *buffer, size_t size, const char *name);

/* Holds a folder against a second program that writes the same files, until this one ends, however it does. 0, also where the system
   cannot; -1: another program holds it. */
int output_hold_folder(const char *folder);

#define csv riddle_io_file
#define csv_row riddle_io_row
#define csv_close riddle_io_close
/* header: "time_s,retained_small". A '#' comment line may stand before it: "# a comment\ntime_s,...". NULL after an error. */
csv *csv_open(const char *folder, const char *name, const char *header);
int csv_line(csv *c, const char *format, ...) COMMON_PRINTF(2, 3); /* a row by hand, without the newline */

#define vtk_array riddle_io_array
#define vtk_scalar riddle_io_scalar
#define vtk_scalar_float riddle_io_scalar_float
#define vtk_ints riddle_io_ints
#define vtk_vector riddle_io_vector
#define vtk_vector3 riddle_io_vector3
#define vtk_vector_stride riddle_io_vector_stride
#define vtp_points riddle_io_points
#define vtp_lines riddle_io_lines
#define vtp_polygons riddle_io_polygons
#define vti_cells riddle_io_cells
#define pvd riddle_io_series
#define pvd_open riddle_io_series_open
#define pvd_name riddle_io_series_name
#define pvd_name_as riddle_io_series_name_as
#define pvd_close riddle_io_series_close

#define plot riddle_io_plot
#define plot_new riddle_io_plot_new
#define plot_panel_size riddle_io_plot_panel_size
#define plot_write riddle_io_plot_write
#define plot_free riddle_io_plot_free
#define plot_panel riddle_io_plot_panel
#define plot_title riddle_io_plot_title
#define plot_log_x riddle_io_plot_log_x
#define plot_log_y riddle_io_plot_log_y
#define plot_range_x riddle_io_plot_range_x
#define plot_range_y riddle_io_plot_range_y
#define plot_equal riddle_io_plot_equal
#define plot_legend_outside riddle_io_plot_legend_outside
#define plot_line riddle_io_plot_line
#define plot_points riddle_io_plot_points
#define plot_band riddle_io_plot_band
#define plot_error_bars riddle_io_plot_error_bars
#define plot_bars riddle_io_plot_bars
#define plot_heat riddle_io_plot_heat
#define plot_heat_range riddle_io_plot_heat_range
#define plot_style riddle_io_plot_style
#define plot_horizontal riddle_io_plot_horizontal
#define plot_vertical riddle_io_plot_vertical
#define plot_text riddle_io_plot_text
#define plot_text_share riddle_io_plot_text_share
#define PLOT_DASHED RIDDLE_IO_DASHED
#define PLOT_DOTTED RIDDLE_IO_DOTTED
#define PLOT_MARKED RIDDLE_IO_MARKED
#define PLOT_THIN RIDDLE_IO_THIN
#define PLOT_FAINT RIDDLE_IO_FAINT
#define PLOT_STEPS RIDDLE_IO_STEPS
#define PLOT_NO_LINE RIDDLE_IO_NO_LINE
#define PLOT_NEXT RIDDLE_IO_NEXT
#define PLOT_SAME RIDDLE_IO_SAME
#define PLOT_GREY RIDDLE_IO_GREY
#define PLOT_BLACK RIDDLE_IO_BLACK

#define text_table riddle_io_table
#define table_begin riddle_io_table_begin
#define table_cell riddle_io_table_cell
#define table_end_to riddle_io_table_end
void table_end(text_table *t); /* on stdout; nothing when --quiet */

#endif
