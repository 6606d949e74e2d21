/* screening_findings.h - the statements of Elskamp & Kruggel-Emden (2019), sections 5.1 and 5.2, each with the numbers
   of a study. A comparison of cases is confirmed or refuted where the 95 % interval of the difference between their
   means does not include zero. With one seed there is no interval: how far another run would be from it is not known,
   and nothing is confirmed or refuted by it. */
#ifndef SCREENING_FINDINGS_H
#define SCREENING_FINDINGS_H

#include <stdarg.h>

#include "screen_models.h"
#include "screening_study.h"

typedef enum verdict { CONFIRMED, REFUTED, OPEN, ONE_RUN } verdict;
static const char *const verdict_name[] = {"confirmed", "refuted", "within the scatter", "one run: not known"};

enum { FINDINGS_MAX = 64, FINDING_NUMBERS = 240 };

typedef struct finding {
    const char *claim; /* as the paper has it, shortened; where it stands */
    char numbers[FINDING_NUMBERS];
    verdict holds;
} finding;

typedef struct findings {
    int count;
    finding all[FINDINGS_MAX];
} findings;

static void find_that(findings *f, const char *claim, verdict holds, const char *format, ...) COMMON_PRINTF(4, 5);
static void find_that(findings *f, const char *claim, verdict holds, const char *format, ...) {
    finding *next = &f->all[f->count++];
    va_list arguments;
    va_start(arguments, format);
    next->claim = claim;
    next->holds = holds;
    vsnprintf(next->numbers, sizeof next->numbers, format, arguments);
    va_end(arguments);
}

static verdict yes_or_no(bool holds) { return holds ? CONFIRMED : REFUTED; }

/* Whether a number is above zero by more than chance makes, or below. */
static verdict is_positive(double value, double interval) {
    return isnan(interval) ? ONE_RUN : fabs(value) <= interval ? OPEN : yes_or_no(value > 0.0);
}

/* The same of the second less the first. */
static verdict is_larger(contrast c) { return is_positive(c.difference, c.independent); }

/* Several comparisons that one statement needs: refuted if one is, confirmed if all are. */
static verdict both(verdict a, verdict b) { return a == REFUTED || b == REFUTED ? REFUTED : a == CONFIRMED ? b : a; }

/* ---- section 5.1: the 27 cases; variant k is case k + 1 ---- */

enum { WHOLE = 20, EARLY = 5 };
enum { ONLY_SMALL = 1, ONLY_NEAR_MESH = 2, BOTH = 3 };

/* By how much the second case holds back more than the first, mean over the time from 5 s on, where the paper sees the
   differences. alike > 0: whether they differ by less than that instead. */
static void find_pair(findings *f, const study *st, const char *claim, int classes, int first, int second,
                      double alike) {
    verdict holds = CONFIRMED;
    contrast x[UNDERSIZE];
    char text[UNDERSIZE][64] = {"", ""}, plus_minus[INTERVAL_TEXT];
    for (int c = 0; c < UNDERSIZE; c++) {
        if (!(classes & 1 << c)) continue;
        x[c] = contrast_of(st, first - 1, second - 1, over_time(c, EARLY, WHOLE));
        const double size = fabs(x[c].difference), interval = x[c].independent;
        if (alike > 0.0 && isnan(interval)) holds = ONE_RUN;
        else if (alike > 0.0)
            holds = both(holds, size + interval < alike ? CONFIRMED : size - interval > alike ? REFUTED : OPEN);
        else holds = both(holds, is_larger(x[c]));
        snprintf(text[c], sizeof text[c], "%s%s %+.3f%s", c && classes == BOTH ? ", " : "", c ? "near-mesh" : "small",
                 x[c].difference, within(plus_minus, interval));
    }
    find_that(f, claim, holds, "case %d minus case %d, mean over 5-20 s: %s%s%s", second, first, text[SMALL],
              text[NEAR_MESH], alike > 0.0 ? " (alike: within 0.03)" : "");
}

static void find_more(findings *f, const study *st, const char *claim, int classes, int first, int second) {
    find_pair(f, st, claim, classes, first, second, 0.0);
}
static void find_alike(findings *f, const study *st, const char *claim, int classes, int first, int second) {
    find_pair(f, st, claim, classes, first, second, 0.03);
}

/* What is left of both classes in a case at 20 s: more than a limit, or less. */
static void find_left(findings *f, const study *st, const char *claim, int number, bool some) {
    const double limit = some ? 0.02 : 0.01;
    char plus_minus[UNDERSIZE][INTERVAL_TEXT];
    verdict holds = CONFIRMED;
    statistics s[UNDERSIZE];
    for (int c = 0; c < UNDERSIZE; c++) {
        s[c] = measure_of(st, number - 1, at_time(c, WHOLE));
        holds = both(holds, is_positive(some ? s[c].mean - limit : limit - s[c].mean, s[c].interval));
        within(plus_minus[c], s[c].interval);
    }
    find_that(f, claim, holds, "case %d at 20 s: small %.3f%s, near-mesh %.3f%s (%s %.2f)", number, s[SMALL].mean,
              plus_minus[SMALL], s[NEAR_MESH].mean, plus_minus[NEAR_MESH], some ? "above" : "below", limit);
}

/* A number of the text, met within the interval of the mean and the digits that it is given with. */
static void find_number(findings *f, const study *st, const char *claim, measure m, double paper, double digits) {
    const statistics s = measure_of(st, 4, m);
    if (st->seeds < 2)
        find_that(f, claim, ONE_RUN, "%.3f in one run, whose scatter is not known; text %.3f", s.mean, paper);
    else
        find_that(f, claim, yes_or_no(fabs(s.mean - paper) <= s.interval + digits),
                  "%.3f +- %.3f, one run scatters by %.3f; text %.3f", s.mean, s.interval, s.sd, paper);
}

/* Mean deviation of a case from the paper's model 2 with its published parameters (section 5.3), and its bound
   on our side. */
static double deviation_from_model(const study *st, int v) {
    enum { TIMES = 40 };
    const double diameters[UNDERSIZE] = {class_diameter[SMALL], class_diameter[NEAR_MESH]};
    double time[TIMES], model[UNDERSIZE * TIMES], data[UNDERSIZE * TIMES], parameters[SCREEN_MAX_PARAMETERS];
    const settings *s = &st->variants[v].set;
    const screen_operation operation = {s->amplitude, s->frequency, s->moisture, 0.0};
    screen_def def = screen_default_def();
    def.classes = UNDERSIZE;
    def.diameters = diameters;
    for (int k = 0; k < TIMES; k++) {
        time[k] = 0.5 * (k + 1);
        for (int c = 0; c < UNDERSIZE; c++) data[c * TIMES + k] = measure_of(st, v, at_time(c, time[k])).mean;
    }
    if (screen_published(SCREEN_SUBASINGHE, parameters) != SCREEN_OK ||
        screen_predict(&def, SCREEN_SUBASINGHE, parameters, &operation, TIMES, time, model, NULL, NULL) != SCREEN_OK)
        return (double)NAN;
    return screen_deviation(UNDERSIZE * TIMES, model, data);
}

static void find_in_all_cases(findings *f, const study *st) {
    double constant = 1.0, most_at_5 = 0.0, before = 1.0, after = 0.0, least_left = 1.0;
    int ahead = 0, open = 0, top_ahead = 0;
    for (int v = 0; v < CASES; v++) {
        for (int c = 0; c < UNDERSIZE; c++) {
            const double at_5 = measure_of(st, v, at_time(c, 5.0)).mean,
                         at_10 = measure_of(st, v, at_time(c, 10.0)).mean;
            constant = fmin(constant, measure_of(st, v, at_time(c, 0.5)).mean);
            most_at_5 = fmax(most_at_5, at_5);
            before = fmin(before, (1.0 - at_5) / 4.5), after = fmax(after, (at_5 - at_10) / 5.0);
            if (v >= 9) least_left = fmin(least_left, measure_of(st, v, at_time(NEAR_MESH, WHOLE)).mean);
        }
        double apart[SEEDS_MAX] = {0.0}; /* of the same runs, so that their scatter is that of the difference */
        for (int q = 0; q < st->seeds; q++)
            apart[q] =
                measured(st, v, q, over_time(NEAR_MESH, 0.5, WHOLE)) - measured(st, v, q, over_time(SMALL, 0.5, WHOLE));
        const statistics s = statistics_of(st->seeds, apart);
        const verdict holds = is_positive(s.mean, s.interval);
        ahead += holds == CONFIRMED || (holds == ONE_RUN && s.mean > 0.0), open += holds == OPEN;
        top_ahead += measure_of(st, v, top_layer(NEAR_MESH)).mean > measure_of(st, v, top_layer(SMALL)).mean;
    }
    find_that(f, "retained is constant until 0.5 s, the way to the end of the outlet (5.1)",
              yes_or_no(constant > 0.999), "least of all cases and classes at 0.5 s: %.4f; the delay is an input",
              constant);
    find_that(f, "in all cases most pass in the first 5 s (5.1)", yes_or_no(most_at_5 < 0.5),
              "most retained at 5 s: %.3f", most_at_5);
    find_that(f, "after 5 s the fractions decline only slowly (5.1)", yes_or_no(after < 0.5 * before),
              "fastest over 5-10 s %.3f 1/s, slowest over 0.5-5 s %.3f 1/s", after, before);
    find_that(f, "small decline faster than near-mesh in all cases (5.1)",
              st->seeds < 2           ? ONE_RUN
              : ahead == CASES        ? CONFIRMED
              : open + ahead == CASES ? OPEN
                                      : REFUTED,
              "in %d of 27 cases, %d within the scatter", ahead, open);
    find_that(f, "wet: several particles are left after 20 s (5.1)", yes_or_no(least_left > 0.0),
              "least near-mesh left of the 18 wet cases: %.3f", least_left);
    find_that(f, "near-mesh need longer to the bottom layer than small in all cases (5.2)",
              yes_or_no(top_ahead == CASES), "in %d of 27 cases", top_ahead);
}

static void find_dry(findings *f, const study *st) {
    static const int figure_3[5] = {2, 4, 5, 6, 8};
    char plus_minus[UNDERSIZE][INTERVAL_TEXT];
    double early = 0.0, late = 0.0;
    for (int k = 45; k <= 200; k += 5) { /* largest distance between the curves of figures 3a, b at 4.5 s, and after */
        for (int c = 0; c < UNDERSIZE; c++) {
            double low = 1.0, high = 0.0;
            for (int i = 0; i < 5; i++) {
                const double y = measure_of(st, figure_3[i] - 1, at_time(c, k * SAMPLE)).mean;
                low = fmin(low, y), high = fmax(high, y);
            }
            if (k == 45) early = fmax(early, high - low);
            else late = fmax(late, high - low);
        }
    }
    find_that(f, "dry: nearly unaffected by the agitation until 4.5 s, obvious influence after (5.1)",
              yes_or_no(early < 0.05 && late > early),
              "curves of cases 2, 4, 5, 6, 8 are up to %.3f apart at 4.5 s, up to %.3f later", early, late);
    find_number(f, st, "initial case: 87 % of the small have passed at 5 s (5.1)", at_time(SMALL, 5.0), 0.13, 0.005);
    find_number(f, st, "initial case: 80 % of the near-mesh have passed at 5 s (5.1)", at_time(NEAR_MESH, 5.0), 0.20,
                0.005);
    find_number(f, st, "initial case: 1.5 % of the small are left at 10 s (5.1)", at_time(SMALL, 10.0), 0.015, 0.0005);
    find_number(f, st, "initial case: 10 % of the near-mesh are left at 10 s (5.1)", at_time(NEAR_MESH, 10.0), 0.10,
                0.005);
    find_number(f, st, "initial case: nearly all small have passed after 15 s (5.1)", at_time(SMALL, 15.0), 0.0, 0.02);
    find_number(f, st, "initial case: nearly all near-mesh have passed after 15 s (5.1)", at_time(NEAR_MESH, 15.0), 0.0,
                0.02);
    const contrast small = contrast_of(st, 7, 4, over_time(SMALL, 5.0, 10.0)),
                   near_mesh = contrast_of(st, 7, 4, over_time(NEAR_MESH, 5.0, 10.0));
    find_that(f, "A = 1.2 mm: both decline faster between 5 and 10 s (5.1)",
              both(is_larger(small), is_larger(near_mesh)),
              "case 5 minus case 8, mean over 5-10 s: small %+.3f%s, near-mesh %+.3f%s", small.difference,
              within(plus_minus[SMALL], small.independent), near_mesh.difference,
              within(plus_minus[NEAR_MESH], near_mesh.independent));
    find_more(f, st, "A = 1.2 mm: the small are depleted earlier (5.1)", ONLY_SMALL, 8, 5);
    find_alike(f, st, "A = 1.2 mm: the near-mesh need about the same time (5.1)", ONLY_NEAR_MESH, 5, 8);
    find_more(f, st, "A = 0.8 mm: slower decline of both after 5 s (5.1)", BOTH, 5, 2);
    find_left(f, st, "A = 0.8 mm: an appreciable amount is left at 20 s (5.1)", 2, true);
    find_alike(f, st, "f = 55.4 Hz has nearly the effect of A = 1.2 mm (5.1)", BOTH, 8, 6);
    find_more(f, st, "f = 55.4 Hz: the near-mesh are depleted earlier (5.1)", ONLY_NEAR_MESH, 6, 5);
    find_more(f, st, "f = 45.8 Hz has less effect than A = 0.8 mm (5.1)", BOTH, 4, 2);
    find_left(f, st, "f = 45.8 Hz: some are left after 20 s (5.1)", 4, true);
}

static void find_wet(findings *f, const study *st) {
    find_more(f, st, "2.5 %: a larger amplitude slightly increases the decline (5.1)", BOTH, 17, 14);
    find_more(f, st, "5 %: a larger amplitude slightly increases the decline (5.1)", BOTH, 26, 23);
    find_more(f, st, "2.5 %: a larger frequency increases it more than the amplitude (5.1)", BOTH, 15, 17);
    find_more(f, st, "5 %: a larger frequency increases it more than the amplitude (5.1)", BOTH, 24, 26);
    find_more(f, st, "2.5 %: a lower amplitude reduces the passage (5.1)", BOTH, 14, 11);
    find_more(f, st, "2.5 %: a lower frequency reduces the passage (5.1)", BOTH, 14, 13);
    find_more(f, st, "5 %: a lower amplitude reduces the passage (5.1)", BOTH, 23, 20);
    find_more(f, st, "5 %: a lower frequency reduces the passage (5.1)", BOTH, 23, 22);
    find_alike(f, st, "5 %: larger amplitude with lower frequency is like the initial one (5.1)", BOTH, 23, 25);
    find_more(f, st, "5 %: a larger frequency does not make up for a lower amplitude (5.1)", BOTH, 23, 21);
    find_more(f, st, "5 %: both increased, faster than any one (27 against 24) (5.1)", BOTH, 27, 24);
    find_more(f, st, "5 %: both decreased, slower than any one (19 against 20) (5.1)", BOTH, 20, 19);
    find_more(f, st, "initial A and f: 2.5 % of water holds back more than none (5.1)", BOTH, 5, 14);
    find_more(f, st, "initial A and f: 5 % holds back more than 2.5 % (5.1)", BOTH, 14, 23);
    find_left(f, st, "initial A and f, 2.5 %: some of both are left at 20 s (5.1)", 14, true);
    find_left(f, st, "initial A and f, 5 %: some of both are left at 20 s (5.1)", 23, true);
    find_alike(f, st, "A = 0.8 mm: dry stagnates, its difference to 2.5 % vanishes after 5 s (5.1)", BOTH, 2, 11);
    find_more(f, st, "A = 1.2 mm: 5 % holds back more than none (5.1)", BOTH, 8, 26);
    find_left(f, st, "A = 1.2 mm, 5 %: some are left at 20 s (5.1)", 26, true);
    find_more(f, st, "f = 45.8 Hz: 2.5 % holds back more than none (5.1)", BOTH, 4, 13);
    find_alike(f, st, "f = 45.8 Hz: 5 % differs negligibly from 2.5 % (5.1)", BOTH, 13, 22);
    find_more(f, st, "f = 55.4 Hz: 5 % holds back more than none (5.1)", BOTH, 6, 24);
    find_alike(f, st, "f = 55.4 Hz: small with 2.5 and 5 % differ marginally (5.1)", ONLY_SMALL, 15, 24);
    find_left(f, st, "f = 55.4 Hz, 5 %: all are screened after 20 s (5.1)", 24, false);
    find_more(f, st, "A = 0.8 mm, f = 55.4 Hz: 2.5 % is slightly slower than dry (5.1)", BOTH, 3, 12);
    find_more(f, st, "A = 0.8 mm, f = 55.4 Hz: 5 % is obviously slower than dry (5.1)", BOTH, 3, 21);
    find_alike(f, st, "dry: f = 55.4 Hz makes up for A = 0.8 mm (5.1)", BOTH, 5, 3);
}

/* Top layer: in how many of the steps from one level to the next, all else equal, the time changes as the paper says;
   with one seed by the sign. */
static void find_top_steps(findings *f, const study *st, const char *claim, const int *stride, int strides,
                           double sign) {
    int right = 0, wrong = 0, steps = 0;
    for (int k = 0; k < strides; k++)
        for (int v = 0; v + stride[k] < CASES; v++) {
            if (v / stride[k] % 3 == 2) continue; /* the highest level already */
            for (int c = 0; c < UNDERSIZE; c++, steps++) {
                contrast x = contrast_of(st, v, v + stride[k], top_layer(c));
                x.difference *= sign;
                const verdict holds = is_larger(x) == ONE_RUN ? yes_or_no(x.difference > 0.0) : is_larger(x);
                right += holds == CONFIRMED, wrong += holds == REFUTED;
            }
        }
    find_that(f, claim,
              st->seeds < 2            ? ONE_RUN
              : wrong > steps / 20     ? REFUTED
              : right + wrong == steps ? CONFIRMED
                                       : OPEN,
              "%d steps of one level: %d as stated, %d the other way, %d %s", steps, right, wrong,
              steps - right - wrong, st->seeds < 2 ? "alike (by the sign of one run)" : "within the scatter");
}

static void find_top_layer(findings *f, const study *st) {
    static const int agitation[2] = {3, 1}, water[1] = {9};
    find_number(f, st, "initial case: near-mesh need 3.62 s to the bottom layer (5.2)", top_layer(NEAR_MESH), 3.62,
                0.005);
    find_number(f, st, "initial case: small need 2.05 s to the bottom layer (5.2)", top_layer(SMALL), 2.05, 0.005);
    find_top_steps(f, st, "larger amplitude and frequency shorten the time in the top layer of both (5.2)", agitation,
                   2, -1.0);
    find_top_steps(f, st, "more water extends it in all cases (5.2)", water, 1, 1.0);
}

/* What issue and paper expect of the 27 cases as a whole. */
static void find_model(findings *f, const study *st) {
    double sum = 0.0, low_residue = 1.0, high_residue = 0.0;
    for (int v = 0; v < CASES; v++)
        if (v / 3 % 3 > 0) sum += deviation_from_model(st, v) / 18.0;
    for (int v = 0; v < 3; v++) {
        const double residue = measure_of(st, v, at_time(NEAR_MESH, WHOLE)).mean;
        low_residue = fmin(low_residue, residue), high_residue = fmax(high_residue, residue);
    }
    find_that(f, "A = 1.0 and 1.2 mm: model 2 with the published parameters describes the curves (5.3; below 0.06)",
              yes_or_no(sum < 0.06), "mean deviation of the 18 cases %.4f; the paper's own, all 27: 0.0387", sum);
    find_that(f, "A = 0.8 mm, dry: the screen stagnates (5.1; near-mesh above 0.02 at 20 s)",
              yes_or_no(low_residue > 0.02), "near-mesh left at 20 s: %.3f to %.3f at the three frequencies",
              low_residue, high_residue);
}

static void find_cases(findings *f, const study *st) {
    f->count = 0;
    if ((st->samples - 1) * SAMPLE < WHOLE - 1e-9) return; /* every statement needs the 20 s */
    find_in_all_cases(f, st);
    find_dry(f, st);
    find_wet(f, st);
    find_top_layer(f, st);
    find_model(f, st);
}

/* ---- section 5.2: closed plate and thin layer; variants of one factor in the order of its levels ---- */

/* That a mean over time rises (sign 1) or falls (-1) from one level of a factor to another. */
static void find_trend(findings *f, const study *st, const char *claim, int curve, int from, int to, double sign) {
    const double unit = curve == H_STAR ? 1e3 : 1.0;
    const measure mean = over_time(curve, 0.0, st->variants[0].set.time);
    const statistics first = measure_of(st, from, mean), last = measure_of(st, to, mean);
    contrast x = contrast_of(st, from, to, mean);
    const double difference = x.difference;
    x.difference *= sign;
    char plus_minus[INTERVAL_TEXT];
    find_that(f, claim, is_larger(x), "mean over time %.3f -> %.3f%s, difference %+.3f%s", unit * first.mean,
              unit * last.mean, curve == H_STAR ? " mm" : "", unit * difference,
              within(plus_minus, unit * x.independent));
}

/* The share of its rise, from the start to the last fifth of the time, that h* has reached on average from a twentieth
   to a fifth of it. */
static double risen_early(const study *st, int v, int q) {
    const double time = st->variants[0].set.time, start = measured(st, v, q, at_time(H_STAR, 0.0));
    return (measured(st, v, q, over_time(H_STAR, 0.05 * time, 0.2 * time)) - start) /
           (measured(st, v, q, over_time(H_STAR, 0.8 * time, time)) - start);
}
static void find_slower_rise(findings *f, const study *st, const char *claim, int from, int to) {
    double less[SEEDS_MAX] = {0.0};
    char plus_minus[INTERVAL_TEXT];
    for (int q = 0; q < st->seeds; q++) less[q] = risen_early(st, from, q) - risen_early(st, to, q);
    const statistics s = statistics_of(st->seeds, less);
    find_that(f, claim, is_positive(s.mean, s.interval),
              "share of the own rise that is reached early, less: %.3f%s (pairs)", s.mean,
              within(plus_minus, s.interval));
}

/* order: the n variants of a factor (0 amplitude, 1 frequency, 2 water) by its level. */
static void find_neighbours(findings *f, const study *st, int factor, int n, const int *order) {
    static const char *const plate[3] = {"closed plate: h* grows faster with the amplitude (5.2)",
                                         "closed plate: h* grows faster with the frequency (5.2)",
                                         "closed plate: h* is smaller with water (5.2)"};
    static const char *const thin[3][UNDERSIZE] = {{"thin layer: small pass faster at a lower amplitude (5.2)",
                                                    "thin layer: near-mesh pass faster at a lower amplitude (5.2)"},
                                                   {"thin layer: small pass faster at a lower frequency (5.2)",
                                                    "thin layer: near-mesh pass faster at a lower frequency (5.2)"},
                                                   {"thin layer: small pass slightly faster with 5 % of water (5.2)",
                                                    "thin layer: near-mesh pass faster with 5 % of water (5.2)"}};
    const int scene = st->variants[0].set.scene;
    if (n < 2 || scene == SCENE_SCREEN) return;
    const int low = order[0], high = order[n - 1];
    if (scene == SCENE_CLOSED_PLATE) {
        if (factor == 0) {
            const statistics start = measure_of(st, 0, at_time(H_STAR, 0.0));
            find_that(f, "closed plate: well mixed at the start, h* = 0 (5.2)", yes_or_no(start.mean < 1e-3), "%.2f mm",
                      1e3 * start.mean);
        }
        find_trend(f, st, plate[factor], H_STAR, low, high, factor < 2 ? 1.0 : -1.0);
        if (factor == 2) find_slower_rise(f, st, "closed plate: water slows its growth (5.2)", low, high);
        return;
    }
    for (int c = 0; c < UNDERSIZE; c++) find_trend(f, st, thin[factor][c], c, low, high, factor < 2 ? 1.0 : -1.0);
    if (factor == 2 && n == 3)
        find_trend(f, st, "thin layer: near-mesh pass slower with 2.5 % of water (5.2)", NEAR_MESH, low, order[1], 1.0);
}

/* ---- output ---- */

static void json_findings(json *j, const findings *f) {
    json_array_begin(j, "findings");
    for (int k = 0; k < f->count; k++) {
        json_object_begin(j, NULL);
        json_string(j, "claim", f->all[k].claim);
        json_string(j, "numbers", f->all[k].numbers);
        json_string(j, "verdict", verdict_name[f->all[k].holds]);
        json_object_end(j);
    }
    json_array_end(j);
}

/* On the screen, and as a table for a page. */
static void report_findings(const findings *f, bool one_seed, const char *folder) {
    if (!f->count) return;
    if (one_seed) common_print("One run each: how far others would be from it is not known; --seeds tells.\n");
    riddle_io_file *file = riddle_io_open(folder, "findings.md");
    riddle_io_print(file, "| the paper | here | |\n|---|---|---|\n");
    for (int k = 0; k < f->count; k++) {
        const finding *x = &f->all[k];
        common_print("%-18s  %s: %s\n", verdict_name[x->holds], x->claim, x->numbers);
        riddle_io_print(file, "| %s | %s | %s |\n", x->claim, x->numbers, verdict_name[x->holds]);
    }
    riddle_io_close(file);
}

#endif
