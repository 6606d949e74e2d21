/* wet_pair: two wet spheres (or a sphere and a plate) are pulled apart, and collide.

   1. Pulled apart: the force over the gap, by the header's table, by the closed-form laws and by the laws as printed in
      Elskamp & Kruggel-Emden 2019, against Young-Laplace, for a range of volumes and contact angles.
   2. Collisions: head-on at a range of speeds, volumes and angles. The dry contact is a linear spring with a damper
      that never pulls; the bridge forms at contact and breaks at its dynamic rupture distance. The wet coefficient of
      restitution is the ratio of the speeds after and before; below the sticking velocity the spheres stay together.

   For your own pair: the options (diameters, angles, liquid, --plate).

   Pictures: wet_pair.png, force.svg, curves.svg, restitution.svg, sticking.svg; numbers: force.csv, restitution.csv,
   sticking.csv. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "common.h"
#include "liquid_bridge.h"

static const double degree = RIDDLE_PI / 180.0;

typedef struct scene {
    bridge_pair_def def;
    double density;     /* [kg/m3] */
    double stiffness;   /* of the dry contact [N/m] */
    double restitution; /* dry [-] */
    double volume;      /* of the bridge [m3] */
    int size[2];        /* of the picture [pixels] */
} scene;

/* m_i m_j/(m_i + m_j); a plate does not move [kg] */
static double reduced_mass(const scene *s) {
    double ri = s->def.radius_i, rj = s->def.radius_j, mi = s->density * 4.0 / 3.0 * RIDDLE_PI * ri * ri * ri;
    return isinf(rj) ? mi : mi / (1.0 + ri * ri * ri / (rj * rj * rj));
}

/* Share of critical damping for a restitution e, contact ending when the force does: ln e = -2 zeta
   acos(zeta)/sqrt(1 - zeta^2) (Schwager & Poeschel 2007). Decreasing in zeta; e > 0.1353 here. */
static double damping_share(double e) {
    double low = 0.0, high = 1.0 - 1e-12;
    for (int k = 0; k < 60; k++) {
        double zeta = 0.5 * (low + high);
        if (exp(-2.0 * zeta * acos(zeta) / sqrt(1.0 - zeta * zeta)) > e) low = zeta;
        else high = zeta;
    }
    return 0.5 * (low + high);
}

/* ---- pulled ---- */

enum { GAPS = 120, LAWS = 5, WILLETT = 2 };

static const char *const law_names[LAWS] = {"bridge_attraction", "energy form", "Willett, full fit",
                                            "eqs 12, 13, corrected", "eqs 12, 13, as printed"};

static double law_force(int law, const bridge_pair *pair, const bridge *b, double gap) {
    const bridge_pair_def *d = &pair->def;
    double sigma = d->liquid.surface_tension;
    bool plate = isinf(d->radius_j);
    switch (law) {
    case 0: return bridge_attraction(b, gap);
    case 1: return bridge_force_energy(gap, b->volume, b->radius, d->angle_i, d->angle_j, sigma);
    case WILLETT:
        return bridge_force_willett(gap, b->volume, b->radius, bridge_effective_angle(d->angle_i, d->angle_j), sigma);
    case 3:
        return plate ? bridge_force_tension_plate(gap, b->volume, d->radius_i, d->angle_i, d->angle_j, sigma)
                     : bridge_force_tension(gap, b->volume, b->radius, d->angle_i, d->angle_j, sigma);
    default:
        return plate ? bridge_printed_force_wall(gap, b->volume, d->radius_i, d->angle_i, d->angle_j, sigma)
                     : bridge_printed_force(gap, b->volume, b->radius, d->angle_i, d->angle_j, sigma);
    }
}

static bridge_pair prepared(const program *self, const bridge_pair_def *def) {
    bridge_pair pair;
    bridge_status status = bridge_pair_prepare(&pair, def);
    if (status != BRIDGE_OK) program_refuse(self, "angle-i, --angle-j", NULL, bridge_status_text(status));
    return pair;
}

static bridge formed(const bridge_pair *pair, double volume) {
    bridge b;
    bridge_form(pair, pair->def.radius_i, pair->def.radius_j, 0.5 * volume, 0.5 * volume, 0, &b);
    return b;
}

static const char *solids(const bridge_pair_def *def, char *text, size_t size) {
    if (isinf(def->radius_j))
        snprintf(text, size, "Sphere of %.3g mm on a plate; contact angles %.0f° and %.0f°", 2e3 * def->radius_i,
                 def->angle_i / degree, def->angle_j / degree);
    else
        snprintf(text, size, "Spheres of %.3g and %.3g mm; contact angles %.0f° and %.0f°", 2e3 * def->radius_i,
                 2e3 * def->radius_j, def->angle_i / degree, def->angle_j / degree);
    return text;
}

/* All laws of one bridge, and how far each is from Young-Laplace. */
static void draw_laws(const program *self, const scene *s, const bridge_pair *pair, json *report) {
    bridge b = formed(pair, s->volume);
    double gap[GAPS], mm[GAPS], share[GAPS], exact[GAPS], force[LAWS][GAPS], off[LAWS][GAPS], worst[LAWS] = {0};
    static const result_column columns[] = {
        {NULL, "law", "%s"}, {NULL, "in contact [mN]", "%.4f"}, {NULL, "off, gaps to 0.9 of rupture [%]", "%.3g"}};
    result_table *t = RESULTS(columns),
                 *file = results_of("gap_m,young_laplace_N,table_N,energy_form_N,willett_N,corrected_N,printed_N");
    char text[200];
    for (int k = 0; k < GAPS; k++) {
        double x = (k + 0.0) / (GAPS - 1);
        share[k] = x * x * (3.0 - 2.0 * x); /* dense at both ends */
        gap[k] = share[k] * b.rupture_gap * 0.9999;
        mm[k] = 1e3 * gap[k];
        bridge_shape shape;
        bool solved = bridge_young_laplace(&pair->def, s->volume, gap[k], &shape) == BRIDGE_OK;
        exact[k] = solved ? 1e3 * shape.force : (double)NAN;
        double row[7] = {gap[k], 1e-3 * exact[k]};
        for (int law = 0; law < LAWS; law++) {
            row[2 + law] = law_force(law, pair, &b, gap[k]);
            force[law][k] = 1e3 * row[2 + law];
            off[law][k] = 100.0 * fabs(force[law][k] / exact[k] - 1.0);
            if (share[k] <= 0.9 && off[law][k] > worst[law]) worst[law] = off[law][k];
            off[law][k] = fmax(off[law][k], 1e-4);
        }
        results_add(file, NULL, row, 7);
    }
    results_csv(file, self->out, "force.csv");
    results_free(file);
    riddle_plot *figure = riddle_plot_new(solids(&pair->def, text, sizeof text), 1, 2);
    riddle_plot_panel(figure, 0, 0, "gap [mm]", "attraction [mN]");
    riddle_plot_title(figure, "eqs of Elskamp & Kruggel-Emden");
    const unsigned outside = bridge_outside(pair, pair->def.radius_i, pair->def.radius_j, s->volume);
    for (int law = LAWS - 1; law >= 0; law--) {
        const bool beyond = law == WILLETT && (outside & BRIDGE_OUTSIDE_WILLETT);
        snprintf(text, sizeof text, "%s%s", law_names[law], beyond ? ", outside its fit" : "");
        riddle_plot_line(figure, text, mm, force[law], GAPS);
    }
    double few_mm[GAPS / 6], few[GAPS / 6];
    for (int k = 0; k < GAPS / 6; k++) {
        few_mm[k] = mm[6 * k];
        few[k] = exact[6 * k];
    }
    riddle_plot_points(figure, "Young-Laplace", few_mm, few, GAPS / 6);
    riddle_plot_style(figure, 0, RIDDLE_PLOT_BLACK);
    riddle_plot_panel(figure, 0, 1, "gap / rupture gap [-]", "error against Young-Laplace [%]");
    riddle_plot_log_y(figure);
    riddle_plot_range_y(figure, 1e-3, 1e3);
    for (int law = LAWS - 1; law >= 0; law--) riddle_plot_line(figure, law_names[law], share, off[law], GAPS);
    riddle_plot_write(figure, self->out, "force.svg");

    for (int law = 0; law < LAWS; law++) results_row(t, TEXTS(law_names[law]), force[law][0], worst[law]);
    results_print(t);
    results_free(t);
    for (unsigned flag = 1; flag <= BRIDGE_OUTSIDE_PENDULAR; flag *= 2)
        if (outside & flag) common_print("Outside its range, %s.\n", bridge_outside_text(flag));
    results_values(report, {"outside_flags", outside}, {"bridge_volume_m3", b.volume}, {"rupture_gap_m", b.rupture_gap},
                   {"force_contact_N", bridge_attraction(&b, 0.0)}, {"share_to_i_at_rupture", b.split},
                   {"table_off_percent", worst[0]}, {"printed_off_percent", worst[LAWS - 1]});
}

/* The table for a range of volumes and of angles, with Young-Laplace as points. */
static void draw_curves(const program *self, const scene *s) {
    const double reduced[] = {1e-4, 1e-3, 1e-2, 5e-2}, angles[] = {0.0, 15.0, 30.0, 45.0};
    double mm[GAPS], force[GAPS], few_mm[12], few[12];
    char text[200];
    riddle_plot *figure = riddle_plot_new("Lines: the header's table. Points: Young-Laplace", 1, 2);
    for (int panel = 0; panel < 2; panel++) {
        riddle_plot_panel(figure, 0, panel, "gap [mm]", "attraction [mN]");
        for (int n = 0; n < 4; n++) {
            bridge_pair_def def = s->def;
            if (panel) def.angle_i = def.angle_j = angles[n] * degree;
            bridge_pair pair = prepared(self, &def);
            double volume = panel ? s->volume : reduced[n] * pair.radius * pair.radius * pair.radius;
            bridge b = formed(&pair, volume);
            for (int k = 0; k < GAPS; k++) {
                double x = k / (GAPS - 1.0);
                mm[k] = 1e3 * x * b.rupture_gap;
                force[k] = 1e3 * bridge_attraction(&b, x * b.rupture_gap);
            }
            for (int k = 0; k < 12; k++) {
                bridge_shape shape;
                few_mm[k] = 1e3 * b.rupture_gap * k / 11.0 * 0.9999;
                few[k] = bridge_young_laplace(&def, volume, 1e-3 * few_mm[k], &shape) == BRIDGE_OK ? 1e3 * shape.force
                                                                                                   : (double)NAN;
            }
            if (panel) snprintf(text, sizeof text, "both angles %.0f°", angles[n]);
            else snprintf(text, sizeof text, "V = %.2g µl", 1e9 * volume);
            riddle_plot_line(figure, text, mm, force, GAPS);
            riddle_plot_points(figure, NULL, few_mm, few, 12);
            riddle_plot_style(figure, 0, RIDDLE_PLOT_SAME);
        }
    }
    riddle_plot_write(figure, self->out, "curves.svg");
}

/* ---- thrown ---- */

typedef struct outcome {
    double restitution; /* speed after over speed before; 0: stuck */
    double contact_s;   /* duration of the dry contact */
} outcome;

/* One head-on collision. volume 0: dry. The gap and its rate are all there is to integrate; drag is
   taken implicitly. */
static outcome collide(const scene *s, const bridge_pair *pair, double volume, double speed, bool printed) {
    const bridge_liquid *liquid = &pair->def.liquid;
    double m = reduced_mass(s), gamma = 2.0 * damping_share(s->restitution) * sqrt(s->stiffness * m),
           contact_dt = sqrt(m / s->stiffness) / 250.0;
    double gap = 0.0, v = -speed, touched = 0.0;
    bridge b = {0};
    if (volume > 0.0) {
        if (printed) bridge_form_printed(pair, pair->def.radius_i, pair->def.radius_j, volume, 0.0, 0, &b);
        else b = formed(pair, volume);
    }
    for (long step = 0; step < 20000000 && !common_interrupted(); step++) {
        bool opening = gap > 0.0;
        double dt = contact_dt;
        if (opening) { /* the bridge alone: steps that resolve its layer at contact, its length, and the drag */
            if (b.volume == 0.0) return (outcome){v / speed, touched};
            /* Turned round while wet: it falls back, with less energy than it came with. */
            if (v <= 0.0) return (outcome){0.0, touched};
            if (bridge_is_ruptured(&b, liquid, gap, v)) return (outcome){v / speed, touched};
            dt = 0.01 * fmin(gap + b.width, 0.2 * b.rupture_gap) / v;
            dt = fmin(dt, 0.02 * sqrt(m * b.width / (2.0 * RIDDLE_PI * liquid->surface_tension * b.radius)));
        }
        /* drift, kick, drift; the drag within the kick is linear in v */
        double middle = gap + 0.5 * dt * v;
        bridge_forces still = {0.0, 0.0, 0.0}, moving = still;
        if (b.volume > 0.0) {
            still = printed ? bridge_evaluate_printed(pair, &b, middle, 0.0) : bridge_evaluate(&b, liquid, middle, 0.0);
            moving =
                printed ? bridge_evaluate_printed(pair, &b, middle, 1.0) : bridge_evaluate(&b, liquid, middle, 1.0);
        }
        double push = -s->stiffness * middle - gamma * v, drag = moving.normal - still.normal;
        double contact = middle < 0.0 && push > 0.0 ? push : 0.0;
        double next = (v + dt / m * (contact - still.normal)) / (1.0 + dt * drag / m);
        gap = middle + 0.5 * dt * next;
        v = next;
        if (!opening) touched += dt;
        if (touched > 1e4 * contact_dt) return (outcome){0.0, touched}; /* at rest in contact */
    }
    return (outcome){0.0, touched};
}

/* Closed form: e_wet^2 = e^2 - 2 W/(m v^2), W the table's work from contact to rupture. */
static double hysteretic(const scene *s, const bridge_pair *pair, double volume, double speed) {
    if (!(volume > 0.0)) return s->restitution;
    bridge b = formed(pair, volume);
    return bridge_wet_restitution(bridge_work(&b, 0.0, b.rupture_gap), reduced_mass(s), s->restitution, speed);
}

/* 0.01 to 1 m/s, and closer round the sticking velocity where angles are compared */
static double speed_at(int panel, double share) {
    return (panel ? 0.05 : 0.01) * riddle_exp(riddle_log(panel ? 6.0 : 100.0) * share);
}

static void draw_restitution(const program *self, const scene *s, progress *bar) {
    enum { SPEEDS = 41, FINE = 400, KINDS = 4 };
    const double reduced[KINDS] = {0.0, 1e-4, 1e-3, 1e-2}, angles[KINDS] = {0.0, 15.0, 30.0, 45.0};
    const int speeds = self->quick ? 13 : SPEEDS;
    double speed[SPEEDS], wet[SPEEDS], fine[FINE], closed[FINE];
    char text[200];
    riddle_io_file *file = csv_open(self->out, "restitution.csv",
                                    "volume_m3,angle_i_rad,angle_j_rad,speed_m_s,restitution,closed_form,printed_laws");
    riddle_plot *figure = riddle_plot_new("Wet restitution. Points: simulated. Lines: √(e² − 2 W/(m v²))", 1, 2);
    for (int panel = 0; panel < 2; panel++) {
        riddle_plot_panel(figure, 0, panel, "impact speed [m/s]", "coefficient of restitution [-]");
        riddle_plot_log_x(figure);
        riddle_plot_range_y(figure, -0.02, 1.0);
        for (int n = 0; n < KINDS; n++) {
            bridge_pair_def def = s->def;
            if (panel) def.angle_i = def.angle_j = angles[n] * degree;
            bridge_pair pair = prepared(self, &def);
            double volume = panel ? s->volume : reduced[n] * pair.radius * pair.radius * pair.radius;
            for (int k = 0; k < speeds && !common_interrupted(); k++) {
                speed[k] = speed_at(panel, k / (speeds - 1.0));
                wet[k] = collide(s, &pair, volume, speed[k], false).restitution;
                double row[7] = {volume,   def.angle_i, def.angle_j,
                                 speed[k], wet[k],      hysteretic(s, &pair, volume, speed[k])};
                row[6] = volume > 0.0 ? collide(s, &pair, volume, speed[k], true).restitution : wet[k];
                riddle_io_row(file, row, 7);
                progress_add(bar, 1.0);
            }
            if (panel) snprintf(text, sizeof text, "both angles %.0f°", angles[n]);
            else if (volume > 0.0) snprintf(text, sizeof text, "V = %.2g µl", 1e9 * volume);
            else snprintf(text, sizeof text, "dry");
            for (int k = 0; k < FINE; k++) {
                fine[k] = speed_at(panel, k / (FINE - 1.0));
                closed[k] = hysteretic(s, &pair, volume, fine[k]);
            }
            riddle_plot_line(figure, NULL, fine, closed, FINE);
            riddle_plot_points(figure, text, speed, wet, speeds);
            riddle_plot_style(figure, 0, RIDDLE_PLOT_SAME);
        }
    }
    riddle_io_close(file);
    riddle_plot_write(figure, self->out, "restitution.svg");
}

/* Impact speed at which the two begin to part [m/s], by bisection; infinite if they stick at 10 m/s. */
static double sticking_velocity(const scene *s, const bridge_pair *pair, double volume, bool printed) {
    double low = 1e-4, high = 10.0;
    if (!(collide(s, pair, volume, high, printed).restitution > 0.0)) return (double)INFINITY;
    for (int k = 0; k < 22 && !common_interrupted(); k++) {
        double speed = sqrt(low * high);
        if (collide(s, pair, volume, speed, printed).restitution > 0.0) high = speed;
        else low = speed;
    }
    return sqrt(low * high);
}

static void draw_sticking(const program *self, const scene *s, const bridge_pair *pair, json *report, progress *bar) {
    enum { VOLUMES = 13 };
    const int volumes = self->quick ? 5 : VOLUMES;
    char text[200];
    result_table *t = results_of("volume_m3,work_J,sticking_velocity_m_s,closed_form_m_s,printed_laws_m_s");
    for (int k = 0; k < volumes && !common_interrupted(); k++) {
        double R = pair->radius, volume = 1e-5 * riddle_exp(riddle_log(4e3) * k / (volumes - 1.0)) * R * R * R;
        bridge b = formed(pair, volume);
        double work = bridge_work(&b, 0.0, b.rupture_gap);
        results_row(t, NULL, volume, work, sticking_velocity(s, pair, volume, false),
                    bridge_sticking_velocity(work, reduced_mass(s), s->restitution),
                    sticking_velocity(s, pair, volume, true));
        progress_add(bar, 2.0);
    }
    results_csv(t, self->out, "sticking.csv");
    const double *ul = results_column(t, "volume_m3", 1e9);
    riddle_plot *figure = riddle_plot_new(solids(&pair->def, text, sizeof text), 1, 1);
    riddle_plot_panel(figure, 0, 0, "bridge volume [µl]", "sticking velocity [m/s]");
    riddle_plot_log_x(figure);
    riddle_plot_log_y(figure);
    riddle_plot_points(figure, "simulated", ul, results_column(t, "sticking_velocity_m_s", 1.0), results_rows(t));
    riddle_plot_line(figure, "√(2 W/m) / e", ul, results_column(t, "closed_form_m_s", 1.0), results_rows(t));
    riddle_plot_style(figure, 0, RIDDLE_PLOT_SAME);
    riddle_plot_line(figure, "simulated, laws as printed", ul, results_column(t, "printed_laws_m_s", 1.0),
                     results_rows(t));
    riddle_plot_style(figure, RIDDLE_PLOT_DASHED | RIDDLE_PLOT_MARKED, RIDDLE_PLOT_NEXT);
    riddle_plot_write(figure, self->out, "sticking.svg");
    results_free(t);

    bridge b = formed(pair, s->volume);
    double work = bridge_work(&b, 0.0, b.rupture_gap), m = reduced_mass(s);
    double stick = sticking_velocity(s, pair, s->volume, false), dry = collide(s, pair, 0.0, 0.1, false).restitution;
    double as_printed = sticking_velocity(s, pair, s->volume, true);
    common_print("V = %.3g µl: work to rupture %.4g J; sticks below %.4f m/s (closed form %.4f, laws as printed "
                 "%.4f)%s; dry restitution %.4f\n",
                 1e9 * s->volume, work, stick, bridge_sticking_velocity(work, m, s->restitution), as_printed,
                 isinf(stick) ? ": at every speed to 10 m/s" : "", dry);
    results_values(report, {"work_to_rupture_J", work}, {"reduced_mass_kg", m}, {"restitution_dry", dry},
                   {"sticking_velocity_m_s", stick},
                   {"sticking_velocity_closed_form_m_s", bridge_sticking_velocity(work, m, s->restitution)},
                   {"sticking_velocity_printed_laws_m_s", as_printed});
}

/* ---- the picture ---- */

enum { PROFILE = 40, ROUND = 96 };

/* The liquid's surface from the neck to the wetted circle of one solid, as (radius, distance from the neck): the force
   is the same at every section, F = 2 pi sigma r/sqrt(1 + r'^2) - pi r^2 p. The radius goes with the square of u, which
   removes the pole at the neck. */
static void meridian(const bridge_shape *b, double sigma, double ring, double profile[PROFILE + 1][2]) {
    double z = 0.0;
    profile[0][0] = b->neck, profile[0][1] = 0.0;
    for (int k = 1; k <= PROFILE; k++) {
        for (int q = 0; q < 20; q++) {
            const double u = (k - 1 + (q + 0.5) / 20) / PROFILE, r = b->neck + (ring - b->neck) * u * u;
            const double s = 2.0 * RIDDLE_PI * sigma * r / (b->force + RIDDLE_PI * r * r * b->pressure),
                         steep2 = s * s - 1.0;
            if (steep2 > 0.0) z += (ring - b->neck) * 2.0 * u / (20.0 * PROFILE) / sqrt(steep2);
        }
        profile[k][0] = b->neck + (ring - b->neck) * k * k / (double)(PROFILE * PROFILE), profile[k][1] = z;
    }
}

static void put_lathe(picture *p, double profile[PROFILE + 1][2], double neck, double side) {
    const picture_colour water = {120, 185, 235};
    for (int k = 0; k < PROFILE; k++)
        for (int n = 0; n < ROUND; n++) {
            double corner[2][2][3];
            for (int a = 0; a < 2; a++)
                for (int b = 0; b < 2; b++) {
                    const double angle = 2.0 * RIDDLE_PI * (n + b) / ROUND, r = profile[k + a][0];
                    corner[a][b][0] = neck + side * profile[k + a][1], corner[a][b][1] = r * cos(angle),
                    corner[a][b][2] = r * sin(angle);
                }
            picture_triangle(p, corner[0][0], corner[0][1], corner[1][0], water, PICTURE_SOLID);
            picture_triangle(p, corner[1][1], corner[1][0], corner[0][1], water, PICTURE_SOLID);
        }
}

/* Both solids and the liquid between them at 0.6 of the gap at which it breaks; x runs from i to j. */
static void draw_doublet(const program *self, const scene *s, const bridge_pair *pair) {
    const bridge b = formed(pair, s->volume);
    const double direction[3] = {0.15, 1.0, -0.25}, ri = s->def.radius_i, rj = s->def.radius_j,
                 gap = 0.6 * b.rupture_gap;
    double profile[PROFILE + 1][2], centre[3] = {0.0, 0.0, 0.0};
    bridge_shape shape;
    char text[60];
    if (bridge_young_laplace(&s->def, s->volume, gap, &shape) != BRIDGE_OK) return;
    picture *p = picture_new(s->size[0], s->size[1]);
    picture_sphere(p, centre, ri, picture_class(4));
    centre[0] = ri + gap + (isinf(rj) ? 0.0 : rj);
    if (!isinf(rj)) picture_sphere(p, centre, rj, picture_class(4));
    const double wide = 1.3 * ri, plate[4][3] = {{centre[0], -wide, -wide},
                                                 {centre[0], wide, -wide},
                                                 {centre[0], wide, wide},
                                                 {centre[0], -wide, wide}};
    if (isinf(rj)) {
        picture_triangle(p, plate[0], plate[1], plate[2], picture_steel(), PICTURE_SOLID);
        picture_triangle(p, plate[0], plate[2], plate[3], picture_steel(), PICTURE_SOLID);
    }
    const double sigma = s->def.liquid.surface_tension;
    meridian(&shape, sigma, shape.ring_i, profile);
    const double neck = ri * cos(shape.filling_i) + profile[PROFILE][1];
    put_lathe(p, profile, neck, -1.0);
    meridian(&shape, sigma, shape.ring_j, profile);
    put_lathe(p, profile, neck, 1.0);
    snprintf(text, sizeof text, "bridge of %.3g mm\xc2\xb3, gap %.3g mm", 1e9 * s->volume, 1e3 * gap);
    picture_title(p, text);
    picture_look(p, direction);
    picture_write(p, self->out, "wet_pair.png");
    picture_free(p);
}

int main(int argc, char **argv) {
    scene s = {bridge_pair_default_def(), 2534.1, 1e5, 0.7808, 1e-10, {960, 640}};
    double diameter_i = 5.0, diameter_j = 5.0, angle_i = 15.0, angle_j = 15.0, volume_ul = 0.1;
    bool plate = false;
    option options[] = {
        option_positive("diameter-i", "MM", &diameter_i, 1e3, "diameter of sphere i [mm]"),
        option_positive("diameter-j", "MM", &diameter_j, 1e3, "diameter of sphere j [mm]"),
        option_flag("plate", &plate, "the second solid is a plate that does not move"),
        option_double("angle-i", "DEG", &angle_i, 0.0, 60.0, "contact angle on i [degrees]"),
        option_double("angle-j", "DEG", &angle_j, 0.0, 60.0, "contact angle on j [degrees]"),
        option_positive("volume", "UL", &volume_ul, 1e6, "liquid in the bridge [µl]"),
        option_double("viscosity", "PAS", &s.def.liquid.viscosity, 0.0, 100.0, "of the liquid [Pa s]"),
        option_positive("surface-tension", "N/M", &s.def.liquid.surface_tension, 10.0, "of the liquid [N/m]"),
        option_double("restitution", "E", &s.restitution, 0.2, 0.999, "dry coefficient of restitution [-]"),
        option_positive("stiffness", "N/M", &s.stiffness, 1e9, "of the dry contact [N/m]"),
        option_positive("density", "KG/M3", &s.density, 1e5, "of the spheres [kg/m3]"),
        option_size("size", s.size, "of the picture [pixels]"),
    };
    program self =
        program_start("wet_pair", "Two wet spheres, or a sphere and a plate, pulled apart and thrown at each other.",
                      options, (int)(sizeof options / sizeof *options), argc, argv);
    s.def.radius_i = 0.5e-3 * diameter_i;
    s.def.radius_j = plate ? (double)INFINITY : 0.5e-3 * diameter_j;
    s.def.angle_i = angle_i * degree;
    s.def.angle_j = angle_j * degree;
    s.volume = 1e-9 * volume_ul;
    double smallest, largest;
    const char *field;
    if (bridge_pair_check_def(&s.def, &field) != BRIDGE_OK)
        program_refuse(&self, "diameter-j", NULL, "between 1e-6 and 1e6 times diameter-i");
    bridge_pair pair = prepared(&self, &s.def);
    bridge_volume_range(&pair, s.def.radius_i, s.def.radius_j, &smallest, &largest);
    if (!(s.volume >= smallest && s.volume <= largest)) {
        char value[40], allowed[80];
        snprintf(value, sizeof value, "%g", volume_ul);
        snprintf(allowed, sizeof allowed, "%.3g to %.3g µl for these solids", 1e9 * smallest, 1e9 * largest);
        program_refuse(&self, "volume", value, allowed);
    }
    json *report = json_open(self.json);
    draw_laws(&self, &s, &pair, report);
    draw_curves(&self, &s);
    draw_doublet(&self, &s, &pair);
    progress bar;
    progress_begin(&bar, "colliding", self.quick ? 8.0 * 13.0 + 10.0 : 8.0 * 41.0 + 26.0);
    draw_restitution(&self, &s, &bar);
    draw_sticking(&self, &s, &pair, report, &bar);
    progress_end(&bar);
    if (common_interrupted()) json_discard(report);
    else {
        json_program(report, &self);
        json_close(report);
    }
    return common_exit_status();
}
