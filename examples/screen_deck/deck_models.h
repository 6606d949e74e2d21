/* deck_models.h - process models of screen_models.h on a deck that was measured by deck_measure.h: fitted to one feed
   rate, they predict another; and the deck that a recovery needs. */
#ifndef DECK_MODELS_H
#define DECK_MODELS_H

#include "deck_measure.h"
#include "screen_models.h"

enum { DECK_MODELS = 4 };
static const char *const deck_model_name[DECK_MODELS] = {"0 first order", "1 Dong", "2 Subasinghe", "3 Soldinger"};

/* A measured deck as the models see it: undersize classes along the way from the middle of the feed's place. */
typedef struct deck_curves {
    int classes, points, klass[DECK_CLASSES];
    double diameter[DECK_CLASSES], share[DECK_CLASSES]; /* [m]; of the undersize [-] */
    double length[DECK_STATIONS], time[DECK_STATIONS];  /* way from the feed [m], and the time that it takes [s] */
    double retained[DECK_CLASSES * DECK_STATIONS];      /* [classes][points] */
    double undersize, oversize;                         /* on the deck, if none passed [kg] */
    double recovery[DECK_STATIONS];                     /* of the undersize [-] */
} deck_curves;

static inline double deck_feed_middle(const deck_def *d) {
    return 1.1 * deck_largest(&d->sizes) + 0.5 * d->feed_length;
}

/* Mean velocity along the deck [m/s]. */
static inline double deck_travel(const deck_answer *a) {
    double mass = 0.0, momentum = 0.0;
    for (int z = 0; z < DECK_ZONES; z++)
        if (a->load[z] > 0.0) mass += a->load[z], momentum += a->load[z] * a->velocity[z];
    return momentum / mass;
}

/* Classes that make less than a thousandth of the feed are left out. velocity: of travel, own or assumed [m/s]. */
static inline void deck_take_curves(const deck_answer *a, const deck_classes *classes, const deck_def *d,
                                    double velocity, deck_curves *c) {
    const double origin = deck_feed_middle(d), start = origin + 0.5 * d->feed_length;
    double all = 0.0, fine = 0.0;
    memset(c, 0, sizeof *c);
    for (int k = 0; k < classes->count; k++) all += a->arrived[k];
    for (int k = 0; k < classes->count; k++) {
        const bool passes = classes->edge[k + 1] <= d->aperture[0] * (1.0 + 1e-9);
        if (passes) fine += a->arrived[k];
        if (passes && a->arrived[k] > 1e-3 * all) c->klass[c->classes++] = k;
    }
    for (int s = 0; s < DECK_STATIONS; s++) {
        const double x = (s + 1) * d->length / DECK_STATIONS;
        if (x <= start) continue;
        c->length[c->points] = x - origin, c->time[c->points] = (x - origin) / velocity;
        c->points++;
    }
    double kept = 0.0;
    for (int k = 0; k < c->classes; k++) kept += a->arrived[c->klass[k]];
    for (int k = 0; k < c->classes; k++) {
        c->diameter[k] = a->size[c->klass[k]], c->share[k] = a->arrived[c->klass[k]] / kept;
        for (int p = 0; p < c->points; p++) {
            c->retained[k * c->points + p] = a->retained[c->klass[k]][DECK_STATIONS - c->points + p];
            c->recovery[p] += c->share[k] * (1.0 - c->retained[k * c->points + p]);
        }
    }
    c->undersize = fine / a->duration * d->length / velocity,
    c->oversize = (all - fine) / a->duration * d->length / velocity;
}

/* Models 0, 1, 2 along the length; 3, which is of a batch, along the time in which the bed travels. */
static inline screen_def deck_screen(const deck_curves *c, const deck_def *d, screen_model model) {
    screen_def s = screen_default_def();
    s.aperture = d->aperture[0], s.wire = d->wire[0];
    s.continuous = model != SCREEN_SOLDINGER;
    s.classes = c->classes, s.diameters = c->diameter, s.shares = c->share;
    s.density = d->density;
    s.undersize_mass = c->undersize, s.oversize_mass = c->oversize;
    s.deck_area = d->length * d->width;
    s.coarse_diameter = fmax(deck_largest(&d->sizes), d->aperture[0]);
    s.bulk_density = 0.55 * d->density;
    return s;
}

static inline screen_operation deck_operation(const deck_def *d) {
    const screen_operation o = {fmax(d->amplitude, fabs(d->minor)), d->frequency, d->moisture, d->inclination};
    return o;
}

typedef struct deck_fit {
    screen_model model;
    screen_status status;
    double parameter[SCREEN_MAX_PARAMETERS];
    double deviation;                     /* of the fitted curves: mean |model - DEM| [-] */
    double load_exponent, load_reference; /* models 0, 1, 2: passage goes with (reference/load)^exponent [-], [kg/m2] */
} deck_fit;

/* The same for a deck of another load than that of the fit. */
static inline screen_def deck_screen_of(const deck_fit *fit, const deck_curves *c, const deck_def *d) {
    screen_def s = deck_screen(c, d, fit->model);
    if (fit->model != SCREEN_SOLDINGER) s.load_exponent = fit->load_exponent, s.load_reference = fit->load_reference;
    return s;
}

static inline const double *deck_way(const deck_curves *c, screen_model model) {
    return model == SCREEN_SOLDINGER ? c->time : c->length;
}

static inline void deck_fit_model(const deck_curves *c, const deck_def *d, screen_model model, double load_exponent,
                                  uint64_t seed, deck_fit *fit) {
    const screen_def def = deck_screen(c, d, model);
    const screen_case data = {deck_operation(d), c->points, deck_way(c, model), c->retained};
    screen_fit_options options = screen_default_fit_options(model);
    screen_fit_result result;
    options.seed = seed, options.starts = 8;
    memset(fit, 0, sizeof *fit);
    fit->model = model;
    fit->load_exponent = load_exponent, fit->load_reference = (c->undersize + c->oversize) / (d->length * d->width);
    fit->status =
        c->classes < 1 || c->points < 2 ? SCREEN_TOO_FEW_POINTS : screen_fit(&def, model, 1, &data, &options, &result);
    fit->deviation = (double)NAN;
    if (fit->status != SCREEN_OK) return;
    memcpy(fit->parameter, result.parameter, sizeof fit->parameter);
    fit->deviation = result.deviation;
}

/* Curves by a fitted model on a measured deck's stations, and their deviation. */
static inline double deck_predict(const deck_fit *fit, const deck_curves *c, const deck_def *d, double *retained) {
    const screen_def def = deck_screen_of(fit, c, d);
    const screen_operation o = deck_operation(d);
    screen_status status = fit->status;
    if (status == SCREEN_OK)
        status = screen_predict(&def, fit->model, fit->parameter, &o, c->points, deck_way(c, fit->model), retained,
                                NULL, NULL);
    for (int k = 0; k < c->classes * c->points && status != SCREEN_OK; k++) retained[k] = (double)NAN;
    return status == SCREEN_OK ? screen_deviation(c->classes * c->points, retained, c->retained) : (double)NAN;
}

/* Length from the feed on at which the share `recovery` of the undersize has passed [m]; NaN if not
   within ten decks. */
static inline double deck_length_by_model(const deck_fit *fit, const deck_curves *c, const deck_def *d, double velocity,
                                          double recovery) {
    const screen_def def = deck_screen_of(fit, c, d);
    const screen_operation o = deck_operation(d);
    const double scale = fit->model == SCREEN_SOLDINGER ? velocity : 1.0;
    double way;
    if (fit->status != SCREEN_OK ||
        screen_time_to(&def, fit->model, fit->parameter, &o, recovery, 10.0 * d->length / scale, &way) != SCREEN_OK)
        return (double)NAN;
    return way * scale;
}

/* What a fitted model says of the deck itself at this feed, from the feed's place to the last station: share of the
   undersize that passes [-]; and the largest feed at which that reaches `recovery` [kg/s], NaN where the model does not
   know the load or no feed does. */
static inline void deck_duty_by_model(const deck_fit *fit, const deck_curves *c, const deck_def *d, double velocity,
                                      double recovery, double *efficiency, double *capacity) {
    double retained[DECK_CLASSES];
    screen_flow flow;
    *efficiency = *capacity = (double)NAN;
    if (fit->status != SCREEN_OK) return;
    const screen_def def = deck_screen_of(fit, c, d);
    const screen_operation o = deck_operation(d);
    const screen_duty duty = {d->flow, d->width, c->length[c->points - 1], velocity};
    if (screen_steady(&def, fit->model, fit->parameter, &o, &duty, 1, retained, NULL, NULL, &flow) == SCREEN_OK)
        *efficiency = flow.efficiency;
    if (screen_capacity(&def, fit->model, fit->parameter, &o, &duty, recovery, capacity) != SCREEN_OK)
        *capacity = (double)NAN;
}

/* The same by DEM, between stations; NaN if the deck is shorter. */
static inline double deck_length_by_dem(const deck_curves *c, double recovery) {
    for (int p = 0; p < c->points; p++) {
        if (c->recovery[p] < recovery) continue;
        if (p == 0) return c->length[0];
        return c->length[p - 1] + (recovery - c->recovery[p - 1]) / (c->recovery[p] - c->recovery[p - 1]) *
                                      (c->length[p] - c->length[p - 1]);
    }
    return (double)NAN;
}

#endif
