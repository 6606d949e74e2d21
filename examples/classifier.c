/* Air classification in a deflector wheel by classifier.h, after Weers et al., Minerals 12 (2022) 480, "the paper".

   Draws, for one material and speed (the curves also for the other two speeds), its inputs: fig07_rebound_angle,
   fig09_restitution (with the bars of Thornton & Ning), fig11_contacts; and the counterparts of its results:
   fig08_rebound_on_wheel, fig10_impact_radius, fig12_case_weights, fig13_separation, figA4_contacts_fixed; paths.svg:
   the balance at the hit against the whole path; circuit.svg: the effect of a second stage with recycle. tromp.csv has
   the separation curve. Inputs that the paper only draws are replaced by plausible values (docs/classifier.md).

   Your own material:  classifier --sphericity psi.csv --restitution e.csv --imperfection angle.csv --tangential vt.csv
   --radial vr.csv
                       columns low,high,share (shares add up to 1; angles in degrees, velocities in m/s);
                       --contact-counts n.csv with columns contacts,share
   Your own curve:     --sizes psd.csv      columns low_um,high_um,feed,coarse,fine (shares; feed_sd,coarse_sd,fine_sd
                                            if known, else 2 % of the largest): reconciled to a separation curve with
                                            error bars
                       --measured t.csv     columns size_um,t: drawn beside the model and fitted
                       --calibrate          the gas velocity that gives the measured x50 is found and used (the paper's
                                            one-point calibration); or --x50-um X for a cut known otherwise */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "classifier.h"
#include "common.h"

enum { SIZES = 161, MOST_ROWS = 200, GRID = 121 };

static const char *const material_names[] = {"limestone", "ground glass", "beads"};
static const double speeds[] = {3000.0, 9000.0, 15000.0};

/* ---- input ---- */

static void refuse_file(const program *self, const char *name, const char *path, const char *reason) {
    char text[700];
    snprintf(text, sizeof text, "a usable CSV file (%s)", reason);
    program_refuse(self, name, path, text);
}

/* A table with these columns; leaves where it is none. */
static sheet read_table(const program *self, const char *name, const char *path, sheet_column *columns, int n) {
    sheet data;
    char message[600];
    if (sheet_read(path, columns, n, &data, message, sizeof message)) refuse_file(self, name, path, message);
    if (data.rows > MOST_ROWS) refuse_file(self, name, path, "more than 200 rows");
    common_print("%s\n", data.how);
    return data;
}

/* Makes shares a whole, as far as they were rounded; leaves where they are none. */
static void make_whole(const program *self, const char *name, const char *path, double *share, int n) {
    char text[100];
    double all = 0.0;
    for (int i = 0; i < n; i++) all += share[i];
    snprintf(text, sizeof text, "the shares add up to %.4g %%, not to 100", 100.0 * all);
    if (!(fabs(all - 1.0) <= 0.03)) refuse_file(self, name, path, text);
    for (int i = 0; i < n; i++) share[i] /= all;
}

/* low,high,share -> distribution; classes must follow each other without gaps */
static void read_distribution(const program *self, const char *name, const char *path, char dimension,
                              classifier_distribution *d) {
    if (!path) return;
    sheet_column c[3] = {sheet_want("low", dimension, true), sheet_want("high", dimension, true),
                         sheet_want("share", '%', true)};
    sheet data = read_table(self, name, path, c, 3);
    /* angles without a unit are in degrees */
    const double degrees = dimension == 'W' && c[0].factor == 1.0 ? RIDDLE_PI / 180.0 : 1.0;
    double edge[MOST_ROWS + 1] = {0.0}, share[MOST_ROWS] = {0.0};
    for (int i = 0; i < data.rows; i++) {
        double low = degrees * c[0].value[i];
        if (i > 0 && !(fabs(low - edge[i]) <= 1e-9 * fabs(low)))
            refuse_file(self, name, path, "a class does not begin where the last one ends");
        edge[i] = low;
        edge[i + 1] = degrees * c[1].value[i];
        share[i] = c[2].value[i];
    }
    make_whole(self, name, path, share, data.rows);
    classifier_status status = classifier_histogram(edge, share, data.rows, d);
    if (status != CLASSIFIER_OK) refuse_file(self, name, path, classifier_status_text(status));
    sheet_free(&data);
}

static void read_contacts(const program *self, const char *path, classifier_contacts *c) {
    if (!path) return;
    sheet_column column[2] = {sheet_want("contacts", '#', true), sheet_want("share", '%', true)};
    sheet data = read_table(self, "contact-counts", path, column, 2);
    c->law = CLASSIFIER_COUNTED;
    for (int i = 0; i < CLASSIFIER_BINS; i++) c->share[i] = 0.0;
    c->counts = 0;
    for (int i = 0; i < data.rows; i++) {
        double n = column[0].value[i];
        if (!(n >= 0.0 && n < CLASSIFIER_BINS && n == floor(n)))
            refuse_file(self, "contact-counts", path, "contacts are whole numbers from 0 to 63");
        c->share[(int)n] += column[1].value[i];
        if ((int)n >= c->counts) c->counts = (int)n + 1;
    }
    make_whole(self, "contact-counts", path, c->share, c->counts);
    classifier_weights unused;
    classifier_status status = classifier_contact_weights(c, &unused);
    if (status != CLASSIFIER_OK) refuse_file(self, "contact-counts", path, classifier_status_text(status));
    sheet_free(&data);
}

/* Points of a measured separation curve */
typedef struct measured {
    int n;
    double x[MOST_ROWS], t[MOST_ROWS], sd[MOST_ROWS]; /* [m] [-] [-] */
    bool has_sd;
    double coarse_share, chi_squared; /* from size distributions */
    bool guessed;                     /* nobody gave deviations of the shares: they are found from the data */
    bool from_curve;                  /* found from the scatter about the curve, which the balance does not show */
    int freedom;
    int classes; /* of the distributions, with what the balance makes of them */
    /* [m] [-] [-]; feed, coarse, fine */
    double low[MOST_ROWS], high[MOST_ROWS], tromp[MOST_ROWS], tromp_sd[MOST_ROWS], share[3][MOST_ROWS];
} measured;

static void read_sizes(const program *self, const char *path, measured *m) {
    static const char *const names[6] = {"feed", "coarse", "fine", "feed_sd", "coarse_sd", "fine_sd"};
    sheet_sizes data;
    char message[600];
    if (sheet_read_sizes(path, names, 6, &data, message, sizeof message)) refuse_file(self, "sizes", path, message);
    if (data.n > MOST_ROWS) refuse_file(self, "sizes", path, "more than 200 rows");
    common_print("%s\n", data.how);
    double share[3][MOST_ROWS], sd[3][MOST_ROWS], t[MOST_ROWS], t_sd[MOST_ROWS];
    /* nothing below the first size */
    const int first = data.amount[0][0] == 0.0 && data.amount[1][0] == 0.0 && data.amount[2][0] == 0.0;
    const int n = data.n - first;
    if (data.single)
        refuse_file(self, "sizes", path, "shares of classes, or what passes each size; not of single sizes");
    for (int k = 0; k < 3; k++) {
        double largest = 0.0;
        if (data.above[k] > 1e-3) {
            snprintf(message, sizeof message, "%g of %s is coarser than %g um; a row must say how coarse",
                     data.above[k], names[k], 1e6 * data.size[data.n - 1]);
            refuse_file(self, "sizes", path, message);
        }
        for (int i = 0; i < n; i++) {
            share[k][i] = data.amount[k][i + first] - (i + first > 0 ? data.amount[k][i + first - 1] : 0.0);
            if (share[k][i] > largest) largest = share[k][i];
        }
        for (int i = 0; i < n; i++) sd[k][i] = data.amount[k + 3] ? data.amount[k + 3][i + first] : 0.02 * largest;
    }
    classifier_balance_data balance = {n, share[0], share[1], share[2], sd[0], sd[1], sd[2], (double)NAN, (double)NAN};
    classifier_balance_result result;
    classifier_status status = classifier_reconcile(&balance, t, t_sd, m->share[0], m->share[1], m->share[2], &result);
    if (status != CLASSIFIER_OK) refuse_file(self, "sizes", path, classifier_status_text(status));
    m->coarse_share = result.coarse_share;
    m->chi_squared = result.chi_squared;
    m->freedom = result.freedom;
    m->has_sd = true;
    /* Where nobody gave deviations, 2 % is a guess: the misfit of the balance says how large they are. */
    m->guessed = !data.amount[3] || !data.amount[4] || !data.amount[5];
    const double scale = m->guessed && m->freedom > 0 ? fmax(sqrt(m->chi_squared / m->freedom), 1e-6) : 1.0;
    m->classes = n;
    for (int i = 0; i < n; i++) {
        const double low = i + first > 0 ? data.size[i + first - 1] : 0.0, high = data.size[i + first];
        m->low[i] = low, m->high[i] = high, m->tromp[i] = t[i], m->tromp_sd[i] = scale * t_sd[i];
        if (!(t[i] == t[i] && t_sd[i] < 0.3)) continue; /* a class with next to no feed says nothing */
        m->x[m->n] = low > 0.0 ? sqrt(low * high) : 0.5 * high;
        m->t[m->n] = t[i];
        m->sd[m->n++] = scale * (t_sd[i] > 0.003 ? t_sd[i] : 0.003);
    }
    sheet_free_sizes(&data);
}

/* Fits a curve with a bypass. Guessed deviations are those of the balance, but no less than the scatter about the curve
   shows: a feed that was computed from the products closes every balance. They come from few points, so the ranges
   count Student's t. */
static classifier_status fit_measured(measured *m, classifier_fit_result *fit) {
    double widened[MOST_ROWS], chi = 0.0;
    classifier_fit_result plain;
    classifier_status status =
        classifier_fit(CLASSIFIER_PLITT, CLASSIFIER_FREE_BYPASS, m->x, m->t, m->has_sd ? m->sd : NULL, m->n, fit);
    if (status != CLASSIFIER_OK || !m->guessed) return status;
    for (int i = 0; i < m->n; i++) chi += pow((m->t[i] - classifier_curve_value(&fit->curve, m->x[i])) / m->sd[i], 2.0);
    const double factor = sqrt(chi / fit->dof);
    m->from_curve = factor > 1.0;
    for (int i = 0; i < m->n && m->from_curve; i++) m->sd[i] *= factor;
    for (int i = 0; i < m->classes && m->from_curve; i++) m->tromp_sd[i] *= factor;
    if (classifier_fit(CLASSIFIER_PLITT, CLASSIFIER_FREE_BYPASS, m->x, m->t, NULL, m->n, &plain) != CLASSIFIER_OK)
        return status;
    for (int i = 0; i < m->n; i++) widened[i] = m->sd[i] * plain.student / fit->student;
    return classifier_fit(CLASSIFIER_PLITT, CLASSIFIER_FREE_BYPASS, m->x, m->t, widened, m->n, fit);
}

/* Prints and writes what the balance makes of three size distributions: T of each class with its standard deviation,
   adjusted shares. */
static void write_balance(const program *self, const measured *m) {
    static const result_column columns[] = {{NULL, "class [um]", "%s"},
                                            {"low_m"},
                                            {"high_m"},
                                            {"t", "T [-]", "%.4f"},
                                            {"t_sd", "sd [-]", "%.4f"},
                                            {"feed", "feed [-]", "%.4f"},
                                            {"coarse", "coarse [-]", "%.4f"},
                                            {"fine", "fine [-]", "%.4f"}};
    result_table *t = RESULTS(columns);
    for (int i = 0; i < m->classes; i++) {
        char text[60];
        snprintf(text, sizeof text, "%.4g .. %.4g", 1e6 * m->low[i], 1e6 * m->high[i]);
        results_row(t, TEXTS(text), m->low[i], m->high[i], m->tromp[i], m->tromp_sd[i], m->share[0][i], m->share[1][i],
                    m->share[2][i]);
    }
    results_print(t);
    results_csv(t, self->out, "balance.csv");
    results_free(t);
    common_print("Coarse product %.4f of the feed; balance: chi squared %.3g with %d degrees of freedom.\n",
                 m->coarse_share, m->chi_squared, m->freedom);
    if (m->from_curve)
        common_print("The balance closes better than T follows a curve: was the feed computed from the products? "
                     "Deviations are those of the "
                     "points about the curve.\n");
    common_print("\n");
}

/* Writes the 95 % range of a fitted value, or that there is none. */
static const char *range_of(char *text, size_t size, double low, double high, int digits) {
    if (!(high < HUGE_VAL)) return " (left open by the points)";
    snprintf(text, size, " (%.*f .. %.*f)", digits, low, digits, high);
    return text;
}

static void read_measured(const program *self, const char *path, measured *m) {
    sheet_column c[2] = {sheet_want("size", 'L', true), sheet_want("t", '%', true)};
    sheet data = read_table(self, "measured", path, c, 2);
    for (int i = 0; i < data.rows; i++) {
        m->x[i] = c[0].value[i];
        m->t[i] = c[1].value[i];
        if (!(m->x[i] > 0.0 && m->t[i] >= -0.1 && m->t[i] <= 1.1))
            refuse_file(self, "measured", path, "sizes are above 0, t is a share from 0 to 1");
    }
    m->n = data.rows;
    sheet_free(&data);
}

/* ---- figures ---- */

static double density(const classifier_distribution *d, double x, double h) {
    return (classifier_distribution_above(d, x - h) - classifier_distribution_above(d, x + h)) / (2.0 * h);
}

static void draw_rebound_angles(const program *self, const classifier_def *def) {
    double x[GRID], y[GRID], degree = RIDDLE_PI / 180.0;
    char label[80];
    riddle_plot *figure = riddle_plot_new("Weers et al. (2022), Fig 7: angular imperfection on a plate at rest", 1, 1);
    riddle_plot_panel(figure, 0, 0, "rebound angle − impact angle [°]", "probability density [1/°]");
    for (int k = 0; k < 3; k++) {
        classifier_distribution d = classifier_paper_def((classifier_material)k, 3000.0, NULL).imperfection;
        for (int i = 0; i < GRID; i++) {
            x[i] = -120.0 + 2.0 * i;
            y[i] = degree * density(&d, degree * x[i], degree);
        }
        snprintf(label, sizeof label, "%s, σ = %.0f° (paper)", material_names[k], d.sd / degree);
        riddle_plot_line(figure, label, x, y, GRID);
    }
    if (def->imperfection.shape == CLASSIFIER_HISTOGRAM) {
        for (int i = 0; i < GRID; i++) y[i] = degree * density(&def->imperfection, degree * x[i], degree);
        riddle_plot_line(figure, "your measurement", x, y, GRID);
        riddle_plot_style(figure, RIDDLE_PLOT_STEPS, RIDDLE_PLOT_BLACK);
    }
    riddle_plot_range_y(figure, 0.0, 0.026);
    riddle_plot_write(figure, self->out, "fig07_rebound_angle.svg");
}

/* What particles do between the rim and the first hit */
typedef struct approach {
    double radius[80], angle[GRID], rebound[GRID]; /* probability densities [1/mm] [1/deg] */
    double mean_radius, mean_angle, mean_speed;    /* [m] [rad] [m/s] */
} approach;

static void sample_approach(const classifier_def *def, int per_axis, approach *a) {
    double omega = def->rpm * RIDDLE_PI / 30.0, degree = RIDDLE_PI / 180.0,
           edge = asin(0.5 * def->wheel.thickness / def->wheel.outer_radius);
    double arc = 2.0 * RIDDLE_PI / def->wheel.paddles - 2.0 * edge, each = 1.0 / per_axis;
    double flat = classifier_distribution_mean(&def->sphericity_2d); /* the mean shape, where gas bends the flight */
    classifier_drag drag =
        classifier_hoelzer_sommerfeld(def->sphericity_is_3d ? flat : classifier_rorato(flat), def->basis);
    int hits = 0, n = per_axis;
    *a = (approach){0};
    for (int i = 0; i < n; i++) {
        double v_t = classifier_distribution_at(&def->tangential_velocity, (i + 0.5) * each);
        for (int j = 0; j < n; j++) {
            double v_r = classifier_distribution_at(&def->radial_velocity, (j + 0.5) * each);
            for (int k = 0; k < 4 * n; k++) {
                double ahead = edge + (k + 0.5) * 0.25 * each * arc;
                classifier_impact hit = def->approach_size > 0.0
                                            ? classifier_approach_in_gas(def, drag, def->approach_size, ahead, v_t, v_r)
                                            : classifier_approach(&def->wheel, omega, ahead, v_t, v_r);
                if (!hit.hit) continue;
                hits++;
                a->mean_radius += hit.radius;
                a->mean_angle += hit.angle;
                a->mean_speed += hit.speed;
                int bin = (int)((hit.radius * 1e3 - 23.0) / 0.025);
                if (bin >= 80) bin = 79; /* the rim itself */
                if (bin >= 0) a->radius[bin] += 1.0 / 0.025;
                double at = hit.angle / degree;
                bin = (int)floor(at + 0.5) + 60;
                if (bin >= 0 && bin < GRID) a->angle[bin] += 1.0;
            }
        }
    }
    for (int i = 0; i < 80; i++) a->radius[i] /= hits > 0 ? hits : 1;
    for (int i = 0; i < GRID; i++) a->angle[i] /= hits > 0 ? hits : 1;
    if (hits) {
        a->mean_radius /= hits;
        a->mean_angle /= hits;
        a->mean_speed /= hits;
    }
    /* the rebound's angle minus the impact's: the imperfection under the condition that the particle leaves the face */
    for (int i = 0; i < GRID; i++) {
        double delta = degree * (-120.0 + 2.0 * i), bare = degree * density(&def->imperfection, delta, degree);
        for (int k = 0; k < GRID; k++) {
            double impact = degree * (k - 60);
            if (!(a->angle[k] > 0.0) || fabs(impact + delta) >= 0.5 * RIDDLE_PI) continue;
            double kept = classifier_distribution_above(&def->imperfection, -0.5 * RIDDLE_PI - impact) -
                          classifier_distribution_above(&def->imperfection, 0.5 * RIDDLE_PI - impact);
            a->rebound[i] += a->angle[k] * bare / kept;
        }
    }
}

/* What drag before the hit changes: hit and cut with the straight flight of the paper, and with gas that bends it. */
static void compare_approach(const program *self, const classifier_def defs[3]) {
    riddle_io_file *file = csv_open(
        self->out, "approach_in_gas.csv",
        "rpm,speed_straight,speed_in_gas,angle_straight_deg,angle_in_gas_deg,x50_clean_straight_um,x50_clean_in_gas_um,"
        "x50_straight_um,x50_in_gas_um");
    const classifier_weights clean = {1.0, 0.0, 0.0};
    for (int k = 0; k < 3; k++) {
        classifier_def def = defs[k];
        classifier_model model;
        approach a[2];
        double x50[2][2], rim = def.rpm * RIDDLE_PI / 30.0 * def.wheel.outer_radius, degree = RIDDLE_PI / 180.0;
        def.points = 256;
        if (classifier_init(&model, &def, NULL) != CLASSIFIER_OK) continue;
        x50[1][0] = classifier_quantile(&model, 0.5);
        model.weights = clean;
        x50[0][0] = classifier_quantile(&model, 0.5);
        classifier_free(&model);
        classifier_quantile_in_gas(&def, 0.5, &clean, NULL, &x50[0][1]);
        classifier_quantile_in_gas(&def, 0.5, NULL, NULL, &x50[1][1]);
        sample_approach(&def, 12, &a[0]);
        def.approach_size = x50[1][1];
        sample_approach(&def, 12, &a[1]);
        csv_line(file, "%.0f,%.4f,%.4f,%.2f,%.2f,%.3f,%.3f,%.3f,%.3f", def.rpm, a[0].mean_speed / rim,
                 a[1].mean_speed / rim, a[0].mean_angle / degree, a[1].mean_angle / degree, 1e6 * x50[0][0],
                 1e6 * x50[0][1], 1e6 * x50[1][0], 1e6 * x50[1][1]);
    }
    riddle_io_close(file);
}

static void draw_approach(const program *self, const classifier_def defs[3], json *report, const classifier_def *def) {
    double r[80], x[GRID];
    approach a;
    char label[100];
    int n = self->quick ? 16 : 40;
    for (int i = 0; i < 80; i++) r[i] = 23.0 + 0.025 * (i + 0.5);
    for (int i = 0; i < GRID; i++) x[i] = -120.0 + 2.0 * i;
    riddle_plot *radius = riddle_plot_new("Weers et al. (2022), Fig 10: where particles meet the paddle", 1, 1),
                *angle = riddle_plot_new("Weers et al. (2022), Fig 8: impact and rebound on the turning wheel", 1, 2);
    riddle_plot_panel(radius, 0, 0, "radius of the hit [mm]", "probability density [1/mm]");
    riddle_plot_range_y(radius, 0.0, 5.0);
    double impact[GRID];
    for (int i = 0; i < GRID; i++) impact[i] = i - 60;
    for (int k = 0; k < 3; k++) {
        sample_approach(&defs[k], n, &a);
        snprintf(label, sizeof label, "%.0f 1/min, mean %.2f mm", defs[k].rpm, 1e3 * a.mean_radius);
        riddle_plot_line(radius, label, r, a.radius, 80);
        riddle_plot_style(radius, RIDDLE_PLOT_STEPS, RIDDLE_PLOT_NEXT);
        snprintf(label, sizeof label, "%.0f 1/min, mean %.1f°", defs[k].rpm, a.mean_angle * 180.0 / RIDDLE_PI);
        riddle_plot_panel(angle, 0, 0, "impact angle, negative: sliding inward [°]", "probability density [1/°]");
        riddle_plot_range_y(angle, 0.0, 0.2);
        riddle_plot_line(angle, label, impact + 30, a.angle + 30, 61);
        riddle_plot_style(angle, 0, k);
        snprintf(label, sizeof label, "%.0f 1/min", defs[k].rpm);
        riddle_plot_panel(angle, 0, 1, "rebound angle − impact angle [°]", "probability density [1/°]");
        riddle_plot_line(angle, label, x, a.rebound, GRID);
        riddle_plot_style(angle, k == 1 ? RIDDLE_PLOT_DASHED : k == 2 ? RIDDLE_PLOT_DOTTED : 0, k);
    }
    sample_approach(def, n, &a);
    results_values(report, {"impact_radius_mean_m", a.mean_radius}, {"impact_angle_mean_rad", a.mean_angle},
                   {"impact_speed_mean_m_per_s", a.mean_speed});
    riddle_plot_text_share(radius, 0.03, 0.45, "the last bin also holds hits on the paddle's edge");
    riddle_plot_write(radius, self->out, "fig10_impact_radius.svg");
    riddle_plot_write(angle, self->out, "fig08_rebound_on_wheel.svg");
}

static void draw_restitution(const program *self, const classifier_def *def) {
    /* moduli: paper; Poisson ratios and limiting contact pressures: stand-ins of the size of hardnesses */
    const struct {
        const char *name;
        double modulus, poisson, density, pressure;
    } spheres[] = {{"limestone", 27.1e9, 0.30, 2700.0, 1.2e9}, {"glass", 70e9, 0.22, 2500.0, 5.0e9}};
    double x[GRID], y[GRID], bar_x[2], bar_y[2], top = 0.0;
    char label[120];
    riddle_plot *figure = riddle_plot_new("Weers et al. (2022), Fig 9: coefficient of restitution", 1, 1);
    riddle_plot_panel(figure, 0, 0, "coefficient of restitution [-]", "probability density [-]");
    for (int i = 0; i < GRID; i++) x[i] = i / (GRID - 1.0);
    for (int k = 0; k < 3; k += 2) {
        classifier_distribution d = classifier_paper_def((classifier_material)k, 3000.0, NULL).restitution;
        for (int i = 0; i < GRID; i++) {
            y[i] = density(&d, x[i], 1e-3) * (i == 0 || i == GRID - 1 ? 2.0 : 1.0); /* one-sided at the ends */
            if (y[i] > top) top = y[i];
        }
        riddle_plot_line(figure, k ? "beads (stand-in)" : "limestone, ground glass (stand-in)", x, y, GRID);
    }
    if (def->restitution.shape == CLASSIFIER_HISTOGRAM) {
        for (int i = 0; i < GRID; i++) {
            y[i] = density(&def->restitution, x[i], 1e-3);
            if (y[i] > top) top = y[i];
        }
        riddle_plot_line(figure, "your measurement", x, y, GRID);
        riddle_plot_style(figure, RIDDLE_PLOT_STEPS, RIDDLE_PLOT_BLACK);
    }
    for (int k = 0; k < 2; k++) {
        double modulus = classifier_reduced_modulus(spheres[k].modulus, spheres[k].poisson, 210e9, 0.3);
        double yield = classifier_yield_velocity(spheres[k].pressure, spheres[k].density, modulus);
        bar_x[0] = classifier_thornton_ning(40.0, yield);
        bar_x[1] = classifier_thornton_ning(1.0, yield);
        bar_y[0] = bar_y[1] = top * (1.10 + 0.07 * k);
        snprintf(label, sizeof label, "Thornton & Ning, %s sphere, 40 … 1 m/s", spheres[k].name);
        riddle_plot_line(figure, label, bar_x, bar_y, 2);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    }
    riddle_plot_range_y(figure, 0.0, 1.75 * top);
    riddle_plot_write(figure, self->out, "fig09_restitution.svg");
}

static void draw_contacts(const program *self, const classifier_def *def) {
    double n[12], y[12], q;
    riddle_plot *figure = riddle_plot_new("Weers et al. (2022), Fig 11: contacts with other particles", 1, 1);
    riddle_plot_panel(figure, 0, 0, "contacts between the paddles [-]", "share of the particles [-]");
    for (int k = 0; k < 2; k++) {
        double mean = k ? 0.2 : 1.0, p = 1.0 - (q = mean / (1.0 + mean));
        for (int i = 0; i < 12; i++, p *= q) n[i] = i, y[i] = p;
        riddle_plot_line(figure, k ? "spheres, mean 0.2 (stand-in)" : "bricks, mean 1.0 (stand-in)", n, y, 12);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    }
    if (def->contacts.law == CLASSIFIER_COUNTED) {
        riddle_plot_line(figure, "your counts", (double[]){0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, def->contacts.share,
                         12);
        riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_BLACK);
    }
    riddle_plot_write(figure, self->out, "fig11_contacts.svg");

    double a[13], b[13], c[13], x[13];
    figure = riddle_plot_new("Weers et al. (2022), Fig 12: shares of the collision cases", 1, 1);
    riddle_plot_panel(figure, 0, 0, "contacts with other particles [-]", "share [-]");
    for (int i = 0; i < 13; i++) {
        classifier_weights w = classifier_weights_of(i);
        x[i] = i;
        a[i] = w.clean;
        b[i] = w.thrown;
        c[i] = w.again;
    }
    riddle_plot_line(figure, "A: one clean hit on a paddle", x, a, 13);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_line(figure, "B: thrown out by a particle", x, b, 13);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_line(figure, "C: turned round, hit again", x, c, 13);
    riddle_plot_style(figure, RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_write(figure, self->out, "fig12_case_weights.svg");
}

/* ---- separation ---- */

static double eq6(const classifier_def *def, classifier_basis basis, bool stokes) {
    double r = def->wheel.outer_radius,
           psi = classifier_rorato_clamped(classifier_distribution_mean(&def->sphericity_2d), NULL);
    classifier_balance at = {def->fluid_density,
                             def->viscosity,
                             def->particle_density,
                             r,
                             classifier_radial_velocity(&def->wheel, def->air_flow, r),
                             def->rpm * RIDDLE_PI / 30.0 * r,
                             def->buoyancy};
    return stokes ? classifier_cut_size_stokes(&at)
                  : classifier_cut_size(&at, classifier_hoelzer_sommerfeld(psi, basis), NULL);
}

static int prepare(const program *self, classifier_model *model, const classifier_def *def) {
    classifier_status status = classifier_init(model, def, NULL);
    if (status == CLASSIFIER_OK) return 0;
    const char *field = NULL;
    (void)classifier_check_def(def, &field);
    (void)self;
    return common_fail("%s: %s", field ? field : "model", classifier_status_text(status));
}

static void size_grid(double *x, double low, double high) {
    for (int i = 0; i < SIZES; i++) x[i] = low * pow(high / low, i / (SIZES - 1.0));
}

/* Fig 13: three speeds, the model against the two force balances */
static void draw_separation(const program *self, const classifier_def defs[3], const classifier_def *def,
                            const measured *m, const classifier_fit_result *fit, const char *name) {
    double x[SIZES], um[SIZES], t[SIZES];
    char label[120], title[160];
    snprintf(title, sizeof title, "Weers et al. (2022), Fig 13: separation of %s", name);
    riddle_plot *figure = riddle_plot_new(title, 1, 1);
    riddle_plot_panel_size(figure, 600, 380);
    riddle_plot_panel(figure, 0, 0, "particle size [µm]", "share rejected to the coarse product T [-]");
    riddle_plot_log_x(figure);
    size_grid(x, 1e-6, 3e-4);
    for (int i = 0; i < SIZES; i++) um[i] = 1e6 * x[i];
    bool own = true;
    for (int k = 0; k < 4; k++) {
        if (k == 3 && !own) break;
        const classifier_def *d = k < 3 ? &defs[k] : def;
        if (k < 3 && d->rpm == def->rpm) own = false;
        classifier_model model;
        if (prepare(self, &model, d)) break;
        for (int i = 0; i < SIZES; i++) t[i] = classifier_tromp(&model, x[i], NULL);
        snprintf(label, sizeof label, "%.0f 1/min%s: x50 = %.1f µm", d->rpm,
                 d->rpm < 3000.0 || d->rpm > 15000.0 ? " (not measured)" : "", 1e6 * classifier_quantile(&model, 0.5));
        riddle_plot_line(figure, label, um, t, SIZES);
        riddle_plot_style(figure, 0, k);
        double line_x[2], line_y[2] = {0.0, 1.0};
        line_x[0] = line_x[1] = 1e6 * eq6(d, CLASSIFIER_EQUIVALENT, true);
        riddle_plot_line(figure, k == 0 ? "eq 3 (Stokes, undisturbed gas)" : NULL, line_x, line_y, 2);
        riddle_plot_style(figure, RIDDLE_PLOT_DOTTED, k);
        line_x[0] = line_x[1] = 1e6 * eq6(d, CLASSIFIER_EQUIVALENT, false);
        riddle_plot_line(figure, k == 0 ? "eq 6 (shape, undisturbed gas)" : NULL, line_x, line_y, 2);
        riddle_plot_style(figure, RIDDLE_PLOT_DASHED | RIDDLE_PLOT_THIN, k);
        classifier_free(&model);
    }
    if (m->n) {
        double mx[MOST_ROWS];
        for (int i = 0; i < m->n; i++) mx[i] = 1e6 * m->x[i];
        if (m->has_sd) riddle_plot_error_bars(figure, "measured", mx, m->t, m->sd, m->n);
        else riddle_plot_points(figure, "measured", mx, m->t, m->n);
        riddle_plot_style(figure, 0, RIDDLE_PLOT_BLACK);
        if (fit) {
            for (int i = 0; i < SIZES; i++) t[i] = classifier_curve_value(&fit->curve, x[i]);
            riddle_plot_line(figure, "Plitt curve with bypass, fitted", um, t, SIZES);
            riddle_plot_style(figure, RIDDLE_PLOT_THIN, RIDDLE_PLOT_GREY);
        }
    }
    riddle_plot_legend_outside(figure);
    riddle_plot_write(figure, self->out, "fig13_separation.svg");
}

/* Fig A4, and the three cases alone */
static void draw_fixed_contacts(const program *self, classifier_model *model) {
    double x[SIZES], um[SIZES], t[SIZES], centre = classifier_quantile(model, 0.5);
    char label[80];
    riddle_plot *figure =
        riddle_plot_new("Weers et al. (2022), Fig A4: fixed numbers of contacts, and the cases alone", 1, 1);
    riddle_plot_panel_size(figure, 600, 380);
    riddle_plot_panel(figure, 0, 0, "particle size [µm]", "share rejected to the coarse product T [-]");
    riddle_plot_log_x(figure);
    if (!(centre > 0.0)) centre = 3e-5;
    size_grid(x, 0.4 * centre, 8.0 * centre);
    for (int i = 0; i < SIZES; i++) um[i] = 1e6 * x[i];
    const classifier_weights mixed = model->weights, alone[3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    const char *const cases[3] = {NULL, "case B alone: thrown by a particle", "case C alone: hit again"};
    for (int k = 0; k < 6; k++) {
        model->weights = k < 3 ? classifier_weights_of(k) : k == 3 ? mixed : alone[k - 3];
        for (int i = 0; i < SIZES; i++) t[i] = classifier_tromp(model, x[i], NULL);
        if (k < 3)
            snprintf(label, sizeof label, "%d contact%s%s", k, k == 1 ? "" : "s", k == 0 ? " (case A alone)" : "");
        riddle_plot_line(figure, k < 3 ? label : k == 3 ? "contacts mixed as in Fig 11" : cases[k - 3], um, t, SIZES);
        riddle_plot_style(figure, k > 3 ? RIDDLE_PLOT_DASHED : 0, k == 3 ? RIDDLE_PLOT_BLACK : RIDDLE_PLOT_NEXT);
    }
    model->weights = mixed;
    riddle_plot_legend_outside(figure);
    riddle_plot_write(figure, self->out, "figA4_contacts_fixed.svg");
}

/* The fine product goes through a second wheel of the same setting, whose rejects return; or the coarse product does */
static void draw_circuit(const program *self, const classifier_model *model, json *report) {
    const classifier_circuit_def clean_fine = {2, {CLASSIFIER_TO_COARSE, 0}, {1, CLASSIFIER_TO_FINE}};
    const classifier_circuit_def clean_coarse = {2, {1, CLASSIFIER_TO_COARSE}, {CLASSIFIER_TO_FINE, 0}};
    double x[SIZES], um[SIZES], one[SIZES], fine[SIZES], coarse[SIZES], load[2], loads[SIZES],
        centre = classifier_quantile(model, 0.5), highest = 0.0;
    if (!(centre > 0.0)) return;
    size_grid(x, 0.4 * centre, 8.0 * centre);
    for (int i = 0; i < SIZES; i++) {
        double t[2];
        um[i] = 1e6 * x[i];
        one[i] = t[0] = t[1] = classifier_tromp(model, x[i], NULL);
        if (classifier_circuit(&clean_fine, t, &fine[i], load) != CLASSIFIER_OK ||
            classifier_circuit(&clean_coarse, t, &coarse[i], load) != CLASSIFIER_OK) {
            common_fail("the circuit lets nothing out");
            return;
        }
        loads[i] = load[0];
        if (load[0] > highest) highest = load[0];
    }
    riddle_plot *figure = riddle_plot_new("Two stages with recycle", 1, 1);
    riddle_plot_panel_size(figure, 600, 380);
    riddle_plot_panel(figure, 0, 0, "particle size [µm]", "share in the coarse product; load of stage 1 / feed [-]");
    riddle_plot_log_x(figure);
    riddle_plot_line(figure, "one stage", um, one, SIZES);
    riddle_plot_line(figure, "fines cleaned, rejects return", um, fine, SIZES);
    riddle_plot_line(figure, "coarse cleaned, fines return", um, coarse, SIZES);
    riddle_plot_line(figure, "load of stage 1", um, loads, SIZES);
    riddle_plot_style(figure, RIDDLE_PLOT_DASHED, RIDDLE_PLOT_GREY);
    riddle_plot_legend_outside(figure);
    riddle_plot_write(figure, self->out, "circuit.svg");
    json_number(report, "circuit_largest_load", highest);
}

/* The balance at the instant of the hit against the whole path after it */
static void draw_paths(const program *self, const classifier_def *def, const classifier_model *model) {
    enum { PATH_SIZES = 13 };
    double x[SIZES], um[SIZES], t[SIZES], path_um[PATH_SIZES], path_t[PATH_SIZES], error[PATH_SIZES],
        centre = classifier_quantile(model, 0.5);
    const char *const names[2] = {"path, drag on the radial slip", "path, drag on the whole slip"};
    classifier_def fewer = *def;
    if (!(centre > 0.0)) return;
    fewer.points = self->quick ? 16 : 64;
    size_grid(x, 0.6 * centre, 2.0 * centre);
    for (int i = 0; i < SIZES; i++) {
        um[i] = 1e6 * x[i];
        t[i] = classifier_tromp(model, x[i], NULL);
    }
    riddle_plot *figure = riddle_plot_new("Balance at the hit against the path after it", 1, 1);
    riddle_plot_panel_size(figure, 600, 380);
    riddle_plot_panel(figure, 0, 0, "particle size [µm]", "share rejected to the coarse product T [-]");
    riddle_plot_line(figure, "balance (the model)", um, t, SIZES);
    riddle_plot_style(figure, 0, RIDDLE_PLOT_BLACK);
    for (int slip = 0; slip < 2; slip++) {
        int n = 0;
        for (int i = 0; i < PATH_SIZES && !common_interrupted(); i++) {
            double size = 0.6 * centre * pow(2.0 / 0.6, i / (PATH_SIZES - 1.0));
            if (classifier_trajectory_tromp(&fewer, size, (classifier_slip)slip, &path_t[i], &error[i]) !=
                CLASSIFIER_OK)
                break;
            path_um[n++] = 1e6 * size;
        }
        riddle_plot_error_bars(figure, names[slip], path_um, path_t, error, n);
        riddle_plot_style(figure, 0, slip);
    }
    riddle_plot_legend_outside(figure);
    riddle_plot_write(figure, self->out, "paths.svg");
}

/* ---- the program ---- */

/* What the model gives for the wanted speed. */
typedef struct outcome {
    classifier_def def;
    classifier_result r;
    unsigned flags;                          /* of the inputs of that speed */
    double x[SIZES], t[SIZES];               /* the curve [m], [-] */
    double eq3, eq6, eq6_projected, seconds; /* cut sizes of the balances [m]; what the curve took */
} outcome;

/* A file that is a distribution, but not of that quantity; or --contacts for something odd. */
static void refuse_definition(const program *self, const classifier_def *def) {
    const char *field;
    if (classifier_check_def(def, &field) == CLASSIFIER_OK) return;
    const char *option_name = !strcmp(field, "sphericity_2d")          ? "sphericity"
                              : !strcmp(field, "tangential_velocity")  ? "tangential"
                              : !strcmp(field, "radial_velocity")      ? "radial"
                              : !strcmp(field, "particle_restitution") ? "restitution"
                                                                       : field;
    program_refuse(self, option_name, NULL,
                   "values in its range: restitution and sphericity 0 .. 1, inward velocity >= 0, angles with rebounds "
                   "off the face");
}

/* Scales the gas velocities so that the wanted speed has this cut size: the paper's proposal, one point
   serves all speeds. */
static void calibrate_to(const program *self, double x50_um, classifier_def *def, classifier_def defs[3]) {
    classifier_def calibrated;
    if (classifier_calibrate(def, 1e-6 * x50_um, NULL, &calibrated) != CLASSIFIER_OK)
        program_refuse(self, "x50-um", NULL, "a cut size that some gas velocity gives");
    double ratio = calibrated.radial_factor / def->radial_factor;
    *def = calibrated;
    for (int k = 0; k < 3; k++) defs[k].radial_factor *= ratio;
    common_print("Calibrated to %.2f um: gas velocity factor %.3f (before: %.3f)\n", x50_um, def->radial_factor,
                 def->radial_factor / ratio);
}

static classifier_status evaluate(const classifier_model *model, outcome *o) {
    double centre = classifier_quantile(model, 0.5);
    if (!(centre > 0.0)) centre = eq6(&o->def, CLASSIFIER_EQUIVALENT, false);
    size_grid(o->x, 0.1 * centre, 10.0 * centre);
    o->eq3 = eq6(&o->def, CLASSIFIER_EQUIVALENT, true);
    o->eq6 = eq6(&o->def, CLASSIFIER_EQUIVALENT, false);
    o->eq6_projected = eq6(&o->def, CLASSIFIER_PROJECTED, false);
    return classifier_separate(model, o->x, o->t, SIZES, &o->r);
}

static void write_curve(const program *self, const classifier_model *model, const double *x) {
    riddle_io_file *file =
        csv_open(self->out, "tromp.csv",
                 "# share of a size that is rejected to the coarse product, half width of its 95 % interval, cases "
                 "alone\nsize_m,t,t_error,t_a,t_b,t_c");
    for (int i = 0; i < SIZES; i++) {
        double error;
        const double share = classifier_tromp(model, x[i], &error);
        double line[6] = {x[i], share, error};
        classifier_tromp_cases(model, x[i], line + 3);
        riddle_io_row(file, line, 6);
    }
    riddle_io_close(file);
}

/* Of the material by its name, and by its key in the report. */
static void tell_outcome(json *report, const outcome *o, const char *material, const char *key) {
    const classifier_def *def = &o->def;
    const classifier_result *r = &o->r;
    const double weights[3] = {r->weights.clean, r->weights.thrown, r->weights.again};
    const double undisturbed = classifier_radial_velocity(&def->wheel, def->air_flow, def->wheel.outer_radius);
    common_print("%s, %.0f 1/min, %g m3/h, rim %.2f m/s, gas %.2f m/s (undisturbed %.2f)\n\n", material, def->rpm,
                 3600.0 * def->air_flow, def->rpm * RIDDLE_PI / 30.0 * def->wheel.outer_radius,
                 def->radial_factor * undisturbed, undisturbed);
    json_string(report, "material", key);
    json_string(report, "basis", def->basis == CLASSIFIER_PROJECTED ? "projected" : "equivalent");
    results_values(report, {"rpm", def->rpm}, {"air_m3_per_s", def->air_flow}, {"radial_factor", def->radial_factor},
                   {"x25_m", r->x25, "x25 [um]", "%.2f", 1e6}, {"x50_m", r->x50, "x50 [um]", "%.2f", 1e6},
                   {"x75_m", r->x75, "x75 [um]", "%.2f", 1e6}, {"x50_error_m", r->x50_error},
                   {"sharpness", r->sharpness, "sharpness [-]", "%.3f"}, {"ecart_probable_m", r->ecart_probable},
                   {"t_error", r->t_error, "error of T [-]", "%.1e"}, {"re50", r->re50, "Re at x50", "%.0f"},
                   {"eq3_m", o->eq3, "eq 3 [um]", "%.2f", 1e6}, {"eq6_m", o->eq6, "eq 6 [um]", "%.2f", 1e6},
                   {"eq6_projected_m", o->eq6_projected, "eq 6, projected [um]", "%.2f", 1e6}, {"missed", r->missed},
                   {"clamped", r->clamped}, {"model_s", o->seconds});
    json_array(report, "case_weights", weights, 3);
    json_array(report, "x_m", o->x, SIZES);
    json_array(report, "tromp", o->t, SIZES);
    json_bool(report, "cut_outside", (r->flags & CLASSIFIER_CUT_OUTSIDE) != 0);
    json_bool(report, "extrapolated", (o->flags & CLASSIFIER_EXTRAPOLATED) != 0);
    common_print("\nCases: clean %.3f, thrown by a particle %.3f, hit again %.3f. Model and curve: %.1f ms.\n",
                 r->weights.clean, r->weights.thrown, r->weights.again, 1e3 * o->seconds);
    if (o->flags & CLASSIFIER_EXTRAPOLATED)
        common_print(
            "Note: the paper measured 3000 .. 15000 1/min; inputs that depend on the speed are held at the end.\n");
    if (r->flags & CLASSIFIER_CUT_OUTSIDE)
        common_print("Note: a cut lies outside %g .. %g um.\n", 1e6 * def->size_low, 1e6 * def->size_high);
    if (r->flags & CLASSIFIER_MISSED)
        common_print("Note: %.1f %% of the particles pass between the paddles untouched.\n", 100.0 * r->missed);
    if (r->clamped > 1e-3)
        common_print("Note: %.1f %% of the sphericities lie outside the conversion's range and were set to its end.\n",
                     100.0 * r->clamped);
}

static void print_fit(const classifier_fit_result *fit) {
    char range[3][60];
    common_print("Measured curve: x50 %.2f%s um, slope %.2f%s, bypass %.3f%s, rms %.3f (95 %% ranges, %.0f degrees of "
                 "freedom)\n",
                 1e6 * fit->curve.size, range_of(range[0], sizeof *range, 1e6 * fit->size_low, 1e6 * fit->size_high, 2),
                 fit->curve.slope, range_of(range[1], sizeof *range, fit->slope_low, fit->slope_high, 2),
                 fit->curve.bypass, range_of(range[2], sizeof *range, fit->bypass_low, fit->bypass_high, 3), fit->rms,
                 fit->dof);
}

static void report_fit(json *report, const classifier_fit_result *fit) {
    json_object_begin(report, "fit");
    results_values(report, {"x50_m", fit->curve.size}, {"x50_sd_m", fit->size_sd}, {"x50_low_m", fit->size_low},
                   {"x50_high_m", fit->size_high}, {"degrees_of_freedom", fit->dof}, {"slope", fit->curve.slope},
                   {"bypass", fit->curve.bypass}, {"slope_low", fit->slope_low}, {"slope_high", fit->slope_high},
                   {"bypass_low", fit->bypass_low}, {"bypass_high", fit->bypass_high}, {"rms", fit->rms});
    json_object_end(report);
}

int main(int argc, char **argv) {
    static const char *const keys[3] = {"limestone", "ground-glass", "beads"};
    int material = 0, basis = 0, law = 0;
    double rpm = 3000.0, air = 75.0, contacts = 1.0, x50 = 0.0, factor = 2.7;
    bool calibrate = false;
    const char *sphericity = NULL, *restitution = NULL, *imperfection = NULL, *tangential = NULL, *radial = NULL,
               *counts = NULL, *sizes = NULL, *points = NULL;
    option options[] = {
        option_choice("material", &material, "limestone|ground-glass|beads",
                      "the paper's materials: density, shape, rebound, contacts"),
        option_positive("rpm", "N", &rpm, 1e6,
                        "rotor speed [1/min]; outside 3000 .. 15000 inputs are held at the ends"),
        option_positive("air-m3-per-h", "Q", &air, 1e6, "air flow [m3/h]"),
        option_choice("basis", &basis, "equivalent|projected",
                      "area of the drag coefficient; projected reproduces the paper"),
        option_choice("drag", &law, "hoelzer-sommerfeld|schiller-naumann|stokes",
                      "drag law; the last two ignore the shape"),
        option_double("contacts", "MEAN", &contacts, 0.0, 1e6,
                      "mean number of contacts, geometric; default 1, beads 0.2"),
        option_positive("radial-factor", "CHI", &factor, 1e3,
                        "gas velocity before the paddle / undisturbed [-]; default 2.7 .. 4.3 by speed"),
        option_string("sphericity", "FILE", &sphericity, "2D sphericity: CSV with low,high,share"),
        option_string("restitution", "FILE", &restitution, "coefficient of restitution: CSV with low,high,share"),
        option_string("imperfection", "FILE", &imperfection,
                      "rebound - impact angle [degrees]: CSV with low,high,share"),
        option_string("tangential", "FILE", &tangential,
                      "velocity of entering particles against the wheel [m/s]: CSV with low,high,share"),
        option_string("radial", "FILE", &radial,
                      "velocity of entering particles inward [m/s]: CSV with low,high,share"),
        option_string("contact-counts", "FILE", &counts, "contacts counted: CSV with contacts,share"),
        option_string("sizes", "FILE", &sizes,
                      "size distributions of feed, coarse and fine: low_um,high_um,feed,coarse,fine, or classes or "
                      "sieves as a laboratory "
                      "writes them"),
        option_string("measured", "FILE", &points, "measured separation curve: CSV with size_um,t"),
        option_flag("calibrate", &calibrate, "find the gas velocity that gives the measured x50"),
        option_double("x50-um", "X", &x50, 0.0, 1e4, "calibrate to this cut size [um]; 0: off"),
    };
    program self = program_start(
        "classifier", "Separation curve of a deflector-wheel classifier, from the rebound of single particles.",
        options, (int)(sizeof options / sizeof *options), argc, argv);
    if (counts && is_given(&self, "contacts"))
        program_refuse(&self, "contacts", NULL, "either --contacts or --contact-counts");
    if (sizes && points) program_refuse(&self, "measured", points, "either --measured or --sizes");
    if (calibrate && !sizes && !points)
        program_refuse(&self, "calibrate", NULL, "only with --measured or --sizes; else --x50-um");

    static outcome o;
    classifier_def defs[3];
    for (int k = 3; k >= 0; k--) { /* the wanted speed, and the paper's three for comparison */
        classifier_def *d = k == 3 ? &o.def : &defs[k];
        *d = classifier_paper_def((classifier_material)material, k == 3 ? rpm : speeds[k], k == 3 ? &o.flags : NULL);
        d->air_flow = air / 3600.0;
        d->basis = basis ? CLASSIFIER_PROJECTED : CLASSIFIER_EQUIVALENT;
        d->law = (classifier_drag_law)law;
        d->seed = self.seed;
        if (is_given(&self, "contacts")) d->contacts.mean = contacts;
        if (is_given(&self, "radial-factor")) d->radial_factor = factor;
        d->points = self.quick ? 256 : 4096; /* T within 1e-4 at every size */
        read_distribution(&self, "sphericity", sphericity, '#', &d->sphericity_2d);
        read_distribution(&self, "restitution", restitution, '#', &d->restitution);
        read_distribution(&self, "imperfection", imperfection, 'W', &d->imperfection);
        read_distribution(&self, "tangential", tangential, 'v', &d->tangential_velocity);
        read_distribution(&self, "radial", radial, 'v', &d->radial_velocity);
        read_contacts(&self, counts, &d->contacts);
        if (restitution) d->particle_restitution = d->restitution.mean;
    }
    refuse_definition(&self, &o.def);

    static measured m;
    classifier_fit_result fit;
    bool fitted = false;
    if (sizes) read_sizes(&self, sizes, &m);
    if (points) read_measured(&self, points, &m);
    if (m.n) {
        const classifier_status status = fit_measured(&m, &fit);
        fitted = status == CLASSIFIER_OK;
        if (!fitted && calibrate)
            refuse_file(&self, sizes ? "sizes" : "measured", sizes ? sizes : points, classifier_status_text(status));
        if (!fitted) common_print("The points are drawn without a curve: %s\n", classifier_status_text(status));
        if (calibrate && x50 <= 0.0) x50 = 1e6 * fit.curve.size; /* of the curve without bypass: the model has none */
    }
    if (x50 > 0.0) calibrate_to(&self, x50, &o.def, defs);

    double began = machine_seconds();
    classifier_model model;
    if (prepare(&self, &model, &o.def)) return common_exit_status();
    const classifier_status status = evaluate(&model, &o);
    o.seconds = machine_seconds() - began;
    if (status != CLASSIFIER_OK) return common_fail("%s", classifier_status_text(status)), common_exit_status();
    write_curve(&self, &model, o.x);
    json *report = json_open(self.json);
    tell_outcome(report, &o, material_names[material], keys[material]);
    if (m.classes) write_balance(&self, &m);
    if (fitted) print_fit(&fit), report_fit(report, &fit);
    if (sizes) {
        results_values(report, {"coarse_share", m.coarse_share}, {"chi_squared", m.chi_squared},
                       {"freedom", m.freedom});
    }
    char name[100];
    snprintf(name, sizeof name, "%s at %g m³/h", material_names[material], air);
    draw_rebound_angles(&self, &o.def);
    draw_approach(&self, defs, report, &o.def);
    compare_approach(&self, defs);
    draw_restitution(&self, &o.def);
    draw_contacts(&self, &o.def);
    draw_separation(&self, defs, &o.def, &m, fitted ? &fit : NULL, name);
    draw_fixed_contacts(&self, &model);
    draw_paths(&self, &o.def, &model);
    draw_circuit(&self, &model, report);
    classifier_free(&model);
    json_program(report, &self);
    json_close(report);
    return common_exit_status();
}
