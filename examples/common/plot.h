/* plot.h: SVG figures for slides: panels in rows and columns; lines, points, bands, error bars, bars, heat maps; axes, units, a legend.

       plot *figure = plot_new("Batch screening, case 5", 1, 2);                // one row, two columns
       plot_panel(figure, 0, 0, "time [s]", "fraction retained [-]");           // what follows goes there
       plot_line(figure, "small", t, small, n);
       plot_points(figure, "small, measured", t_measured, measured, m);
       plot_panel(figure, 0, 1, "error [-]", "run time [s]");
       plot_log_x(figure);
       plot_log_y(figure);
       plot_line(figure, "velocity Verlet", error, seconds, k);
       plot_style(figure, PLOT_DASHED | PLOT_MARKED, PLOT_SAME);                // the series just added: dashed, points, colour as before
       plot_write(figure, self.out, "case.svg");                                // writes and frees

   Data are copied. Values that are not finite (or not positive on a log axis) are left out and break a line. Text is UTF-8 and is escaped.
   Panels without a call stay empty. A series with the label NULL or "" does not stand in the legend. */
#ifndef RIDDLE_PLOT_H
#define RIDDLE_PLOT_H

typedef struct plot plot;

plot *plot_new(const char *title, int rows, int columns);   /* title may be NULL; 1 to 6 rows and columns */
void plot_panel_size(plot *p, double width, double height); /* of every panel, in points; default 540 x 360 for one, smaller for several */
int plot_write(plot *p, const char *folder, const char *name); /* 0, or -1 after one line on stderr; frees the figure in both cases */
void plot_free(plot *p);

/* Chooses the panel that the following calls work on. */
void plot_panel(plot *p, int row, int column, const char *x_label, const char *y_label);
void plot_title(plot *p, const char *title); /* of the panel */
void plot_log_x(plot *p);
void plot_log_y(plot *p);
void plot_range_x(plot *p, double low, double high); /* default: the data with a small margin */
void plot_range_y(plot *p, double low, double high);
void plot_equal(plot *p);          /* same length for one unit on both axes */
void plot_legend_outside(plot *p); /* right of the panel; default: inside where no data are, else outside */

/* Series; n points. Each takes the next colour. */
void plot_line(plot *p, const char *label, const double *x, const double *y, int n);
void plot_points(plot *p, const char *label, const double *x, const double *y, int n);
void plot_band(plot *p, const char *label, const double *x, const double *low, const double *high, int n);
void plot_error_bars(plot *p, const char *label, const double *x, const double *y, const double *plus_minus, int n);
/* Bars beside each other, one group a name; call again for the next series of the same groups. */
void plot_bars(plot *p, const char *label, const char *const *names, const double *values, int n);
/* values[row][column], row 0 at the bottom, between the given corners; colour bar with its label at the right. */
void plot_heat(plot *p, const char *label, const double *values, int columns, int rows, double x0, double x1, double y0, double y1);
void plot_heat_range(plot *p, double low,
                     double high); /* of the colours of the heat map just added; default: its values. To compare panels */

/* The series just added. */
enum { PLOT_DASHED = 1, PLOT_DOTTED = 2, PLOT_MARKED = 4, PLOT_THIN = 8, PLOT_FAINT = 16, PLOT_STEPS = 32, PLOT_NO_LINE = 64 };
enum { PLOT_NEXT = -1, PLOT_SAME = -2, PLOT_GREY = -3, PLOT_BLACK = -4 }; /* colours; 0 .. 7 from the palette */
void plot_style(plot *p, int flags, int colour);

/* Reference lines over the whole panel, and text at a place in data coordinates (or share 0..1 of the panel). */
void plot_horizontal(plot *p, const char *label, double y);
void plot_vertical(plot *p, const char *label, double x);
void plot_text(plot *p, double x, double y, const char *text);
void plot_text_share(plot *p, double x_share, double y_share, const char *text);

#endif
