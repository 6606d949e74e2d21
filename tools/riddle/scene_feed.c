/* scene_feed.c: see scene_feed.h */
#include "scene_feed.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene_shapes.h"
#include "scene_sieves.h"
#include "scene_walls.h"
#include "sheet.h"

enum { CLASSES_MAX = 1000, DRAWS = 4000 };

int scene_region(tree_file *file, const region_def *def, dem_region *region) {
    if (def->box.part.where) {
        for (int c = 0; c < 3; c++)
            if (!(def->box.low[c] <= def->box.high[c]))
                return tree_fail(file, def->box.part.where, "box: low is above high along %c", "xyz"[c]);
        *region = dem_box_region(scene_vec(def->box.low), scene_vec(def->box.high));
    } else if (def->cylinder.part.where) {
        *region = dem_cylinder_region(scene_vec(def->cylinder.bottom), scene_vec(def->cylinder.axis),
                                      def->cylinder.length, def->cylinder.radius);
    } else *region = dem_sphere_region(scene_vec(def->sphere.centre), def->sphere.radius);
    return isfinite(dem_region_volume(region)) ? 0
                                               : tree_fail(file, def->part.where, "region: an axis has no direction");
}

/* ---- classes ---- */

/* A class of a distribution before it is a source. */
typedef struct size_share {
    dem_sizes sizes;
    double share;     /* of mass or number */
    double low, high; /* for its name [m] */
} size_share;

typedef struct size_shares {
    size_share *item;
    int n, by_mass;
} size_shares;

static int add_share(scene *s, size_shares *list, const tree *at, dem_sizes sizes, double share, double low,
                     double high) {
    uint64_t random = 1;
    if (share == 0.0) return 0;
    if (!list->item) list->item = tree_memory(s->file, CLASSES_MAX * sizeof *list->item);
    if (!list->item) return -1;
    if (list->n == CLASSES_MAX) return tree_fail(s->file, at, "more than %d classes", CLASSES_MAX);
    if (!(share > 0.0) || !isfinite(share)) return tree_fail(s->file, at, "a share must be at least 0");
    if (!(dem_draw_size(&sizes, &random) > 0.0))
        return tree_fail(s->file, at, "sizes: 0 < smallest < largest <= 1e6 smallest, and something between them");
    size_share *q = &list->item[list->n++];
    q->sizes = sizes, q->share = share, q->low = low, q->high = high;
    return 0;
}

/* Cuts a list at the sieves: a class that lies in several of them becomes several. */
static int cut_shares(scene *s, size_shares *list) {
    size_shares cut = {NULL, 0, list->by_mass};
    for (int k = 0; k < list->n && s->sieves > 0; k++) {
        const size_share *q = &list->item[k];
        const bool single = q->sizes.kind == DEM_SIZES_LIST;
        const double last = single ? q->sizes.diameter[0] : q->sizes.largest;
        double at = single ? last : q->sizes.smallest, low, high;
        do {
            scene_sieve_class(s, at, &low, &high);
            dem_sizes part = q->sizes;
            const double share = single ? 1.0 : scene_share_between(&q->sizes, low, high);
            if (!single) part.smallest = fmax(part.smallest, low), part.largest = fmin(part.largest, high);
            uint64_t random = 1;
            if (share > 1e-12 && dem_draw_size(&part, &random) > 0.0 && /* else beyond the end of a tail */
                add_share(s, &cut, s->def->measure.part.where, part, share * q->share, low, high))
                return -1;
            at = high;
        } while (high < last);
    }
    if (s->sieves > 0) *list = cut;
    return 0;
}

static const double SIEVE_END = 1e-3; /* a curve ends at 1 to this */

/* Shares of single sizes; or a sieve curve, of which two sizes make a class. What passes the finest size is half as
   large at least. */
static int read_file(scene *s, const sizes_def *def, size_shares *list) {
    char path[1000], message[800];
    const tree *at = fields_where(&def->part, "file");
    sheet_sizes file;
    int failed = 0;
    if (sheet_read_sizes(tree_beside(s->file, def->file, path, sizeof path), NULL, 1, &file, message, sizeof message))
        return tree_fail(s->file, at, "file: %s", message);
    tree_note(s->file, at, "file: %s", file.how);
    const double *size = file.size, *amount = file.amount[0];
    for (int k = 0; k < file.n && file.single && !failed; k++)
        failed = add_share(s, list, at, dem_one_size(size[k]), amount[k], size[k], size[k]);
    if (!file.single && amount[0] > 0.0)
        tree_note(s->file, at, "file: %s: %g %% pass the finest size %g mm: they are %g to %g mm large", path,
                  100.0 * amount[0], 1e3 * size[0], 5e2 * size[0], 1e3 * size[0]);
    for (int k = 0; k < file.n && !file.single && !failed; k++) {
        const double low = k ? size[k - 1] : 0.5 * size[0], share = amount[k] - (k ? amount[k - 1] : 0.0);
        failed = add_share(s, list, at, dem_uniform_sizes(low, size[k], list->by_mass), share, low, size[k]);
    }
    if (!failed && !file.single && !(file.above[0] <= SIEVE_END))
        failed = tree_fail(
            s->file, at,
            "file: %s: passing ends at %.6g: %.4g %% are coarser than %g mm; a row where it is 1 says how coarse", path,
            amount[file.n - 1], 100.0 * file.above[0], 1e3 * size[file.n - 1]);
    sheet_free_sizes(&file);
    return failed ? -1 : 0;
}

/* A shape without sizes comes as it was drawn. */
static int read_drawn(scene *s, const feed_def *feed, size_shares *list) {
    const body_shape *shape;
    if (!feed->shape) return tree_fail(s->file, feed->part.where, "feed: sizes is missing");
    return scene_shape_of(s, feed, &shape) ? -1
                                           : add_share(s, list, feed->part.where, dem_one_size(shape->diameter), 1.0,
                                                       shape->diameter, shape->diameter);
}

static int read_sizes(scene *s, const feed_def *feed, size_shares *list) {
    const sizes_def *def = &feed->sizes;
    const size_class *c = def->classes.item;
    const tree *at = def->part.where;
    if (!at) return read_drawn(s, feed, list);
    list->by_mass = def->shares == 0;
    if (def->file) return read_file(s, def, list);
    for (int k = 0; k < def->classes.n; k++)
        if (add_share(s, list, c[k].part.where, dem_one_size(c[k].diameter), c[k].share, c[k].diameter, c[k].diameter))
            return -1;
    if (def->classes.n) return 0;
    if (!isnan(def->diameter))
        return add_share(s, list, at, dem_one_size(def->diameter), 1.0, def->diameter, def->diameter);
    if (def->uniform.part.where) {
        const double low = def->uniform.smallest, high = def->uniform.largest;
        return add_share(s, list, at, dem_uniform_sizes(low, high, list->by_mass), 1.0, low, high);
    }
    if (def->lognormal.part.where) {
        const lognormal_sizes *l = &def->lognormal;
        return add_share(s, list, at, dem_lognormal_sizes(l->median, l->spread, l->smallest, l->largest, list->by_mass),
                         1.0, l->smallest, l->largest);
    }
    const rosin_sizes *r = &def->rosin_rammler;
    return add_share(s, list, at,
                     dem_rosin_rammler_sizes(r->scale, r->exponent, r->smallest, r->largest, list->by_mass), 1.0,
                     r->smallest, r->largest);
}

/* ---- sources ---- */

static int group_of(scene *s, const feed_def *def, const size_share *c, double density) {
    const char *label = def->label ? def->label : def->shape ? def->shape : "", *bar = label[0] ? "_" : "";
    char name[64];
    if (!def->sizes.part.where) snprintf(name, sizeof name, "%.50s", label);
    else if (c->low == c->high) snprintf(name, sizeof name, "%.40s%s%gmm", label, bar, 1e3 * c->low);
    else if (c->low == 0.0) snprintf(name, sizeof name, "%.40s%sunder_%gmm", label, bar, 1e3 * c->high);
    else if (c->high == HUGE_VAL) snprintf(name, sizeof name, "%.40s%sover_%gmm", label, bar, 1e3 * c->low);
    else snprintf(name, sizeof name, "%.40s%s%g-%gmm", label, bar, 1e3 * c->low, 1e3 * c->high);
    for (char *p = name; *p; p++)
        if (strchr(", \"", *p) || (unsigned char)*p < 32 || *p == 127) *p = '_';
    for (int g = 0; g < s->groups; g++)
        if (strcmp(s->group[g].name, name) == 0 && s->group[g].density == density) return g;
    size_group *g = &s->group[s->groups];
    snprintf(g->name, sizeof g->name, "%s", name);
    g->density = density, g->low = c->low, g->high = c->high;
    return s->groups++;
}

void scene_extremes(const source *q, double *smallest, double *largest) {
    const dem_sizes *z = &q->feed->sizes;
    const bool list = z->kind == DEM_SIZES_LIST;
    *smallest = list ? z->diameter[0] : z->smallest, *largest = list ? z->diameter[0] : z->largest;
}

static void find_means(source *q) {
    uint64_t random = 1;
    q->square = q->cube = 0.0;
    for (int k = 0; k < DRAWS; k++) {
        const double d = dem_draw_size(&q->feed->sizes, &random);
        q->square += d * d / DRAWS, q->cube += d * d * d / DRAWS;
    }
}

/* The thickness of the film, equal for all of a feed, and what one of its particles weighs in the mean [kg]. */
static void find_films(scene *s, source *first, int n, const size_share *const *order, int by_mass) {
    double cube = 0.0, square = 0.0;
    for (int k = 0; k < n; k++) {
        const double of_mass = by_mass ? order[k]->share : order[k]->share * first[k].cube;
        cube += of_mass, square += of_mass / first[k].cube * first[k].square;
    }
    for (int k = 0; k < n && s->def->liquid.part.where; k++)
        first[k].film = s->def->liquid.moisture * first[k].density / s->def->liquid.density * cube / (6.0 * square);
}

static int larger_first(const void *a, const void *b) {
    const size_share *p = *(const size_share *const *)a, *q = *(const size_share *const *)b;
    return p->high < q->high ? 1 : p->high > q->high ? -1 : p < q ? -1 : 1;
}

static int add_sources(scene *s, const feed_def *def, size_shares *list) {
    const size_share *order[CLASSES_MAX];
    source *first = &s->source[s->sources];
    scene_feeder *feeder = &s->feeder[def - (const feed_def *)s->def->feeds.item];
    dem_feed *feeds = &s->feed[s->sources];
    double *share = &s->share[s->sources];
    const body_shape *shape;
    dem_region region;
    int material;
    if (scene_material(s->file, s->def, &def->part, "material", def->material, &material) ||
        scene_region(s->file, &def->region, &region) || scene_shape_of(s, def, &shape))
        return -1;
    if (list->n == 0) return tree_fail(s->file, def->sizes.part.where, "sizes: all shares are 0");
    if (!isnan(def->until) && !(def->until > def->from))
        return tree_fail(s->file, fields_where(&def->part, "until"), "until: after from");
    if (!isnan(def->until) && isnan(def->rate))
        return tree_fail(s->file, fields_where(&def->part, "until"),
                         "until: only with rate; mass and count come all at once, at from");
    for (int k = 0; k < list->n; k++) order[k] = &list->item[k];
    qsort(order, (size_t)list->n, sizeof *order, larger_first);
    for (int k = 0; k < list->n; k++, s->sources++) {
        source *q = &s->source[s->sources];
        memset(q, 0, sizeof *q);
        q->def = def, q->shape = shape;
        q->density = ((const material_def *)s->def->materials.item)[material].density;
        q->group = group_of(s, def, order[k], q->density);
        dem_feed *f = q->feed = &feeds[k];
        *f = dem_default_feed();
        f->region = region, f->sizes = order[k]->sizes, f->material = material, f->group = q->group;
        f->velocity = scene_vec(def->velocity), f->scatter = scene_vec(def->scatter);
        f->clump = shape && shape->clump.spheres ? &shape->clump : NULL;
        f->tries = (int)def->tries;
        if (scene_is_polyhedron(shape) && f->sizes.kind != DEM_SIZES_LIST)
            return tree_fail(s->file, def->sizes.part.where,
                             "sizes: polyhedra come in single sizes: diameter, classes, or a file with shares");
        f->random = s->seed * 1000003u + (uint64_t)s->sources + 1u;
        share[k] = order[k]->share;
        for (int c = 0; c < 3; c++)
            if (!(def->scatter[c] >= 0.0))
                return tree_fail(s->file, fields_where(&def->part, "scatter"), "scatter: at least 0");
        find_means(q);
    }
    find_films(s, first, list->n, order, list->by_mass);
    feeder->first = first;
    feeder->source.feed = feeds, feeder->source.share = share, feeder->source.classes = list->n,
    feeder->source.by_number = !list->by_mass;
    return 0;
}

double scene_number_of(const scene_feeder *f, int class, double time) {
    const feed_def *def = f->first->def;
    double mass = 0.0, number = 0.0, here = 0.0;
    for (int k = 0; k < f->source.classes; k++) {
        const double each = f->first[k].density * RIDDLE_PI / 6.0 * f->first[k].cube, share = f->source.share[k];
        const double of_number = f->source.by_number ? share : share / each;
        mass += of_number * each, number += of_number;
        if (k == class) here = of_number;
    }
    return here * (!isnan(def->count)  ? def->count / number
                   : !isnan(def->mass) ? def->mass / mass
                                       : def->rate * time / mass);
}

/* Whether what comes all at once fits into memory: asked before hours of filling. */
static int check_memory(scene *s) {
    static const double each = 1400.0; /* [B] of a sphere with lists and history; a polyhedron takes no more */
    const double there = machine_free_memory_bytes();
    double all = 0.0;
    for (int k = 0; k < s->def->feeds.n; k++) {
        const scene_feeder *f = &s->feeder[k];
        if (!isnan(f->first->def->rate)) continue;
        for (int c = 0; c < f->source.classes; c++) all += scene_number_of(f, c, 0.0) * scene_pieces(f->first->shape);
        if (!(each * all <= there))
            return tree_fail(s->file, f->first->def->part.where,
                             "feed: %.3g particles take about %.3g GB of memory, of which %.3g GB are free", all,
                             1e-9 * each * all, 1e-9 * there);
    }
    return 0;
}

int scene_add_sources(scene *s) {
    const feed_def *def = s->def->feeds.item;
    const int n = s->def->feeds.n;
    size_shares *lists = tree_memory(s->file, (size_t)n * sizeof *lists);
    int total = 0;
    if (!lists) return -1;
    double smallest = HUGE_VAL, largest = 0.0;
    for (int k = 0; k < n; k++) {
        if (read_sizes(s, &def[k], &lists[k])) return -1;
        for (int c = 0; c < lists[k].n; c++)
            smallest = fmin(smallest, lists[k].item[c].low), largest = fmax(largest, lists[k].item[c].high);
    }
    if (largest > 0.0 && scene_make_sieves(s, smallest, largest)) return -1;
    for (int k = 0; k < n; k++) {
        if (cut_shares(s, &lists[k])) return -1;
        total += lists[k].n;
    }
    s->source = tree_memory(s->file, (size_t)total * sizeof *s->source);
    s->group = tree_memory(s->file, (size_t)total * sizeof *s->group);
    s->feed = tree_memory(s->file, (size_t)total * sizeof *s->feed);
    s->share = tree_memory(s->file, (size_t)total * sizeof *s->share);
    s->feeder = tree_memory(s->file, (size_t)n * sizeof *s->feeder);
    if (!s->source || !s->group || !s->feed || !s->share || !s->feeder) return -1;
    for (int k = 0; k < n; k++)
        if (add_sources(s, &def[k], &lists[k])) return -1;
    return check_memory(s);
}

/* Length of a region along a direction [m]. */
static double extent(const dem_region *r, dem_vec along) {
    const double n[3] = {along.x, along.y, along.z}, size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (r->kind == DEM_REGION_SPHERE) return 2.0 * r->radius;
    if (r->kind == DEM_REGION_CYLINDER) return r->length > 0.0 ? fmin(r->length, 2.0 * r->radius) : 0.0;
    double shortest = HUGE_VAL; /* way through a box from its centre to the first face, twice */
    for (int c = 0; c < 3; c++) {
        const double width = dem_axis(r->high, c) - dem_axis(r->low, c);
        if (fabs(n[c]) > 1e-9 * size) shortest = fmin(shortest, width * size / fabs(n[c]));
    }
    return shortest;
}

double scene_feed_interval(const scene *s, const source *q) {
    const dem_vec v = q->feed->velocity, g = s->world.def.gravity;
    const double speed = sqrt(v.x * v.x + v.y * v.y + v.z * v.z), pull = sqrt(g.x * g.x + g.y * g.y + g.z * g.z);
    double smallest, largest;
    scene_extremes(q, &smallest, &largest);
    if (q->shape) largest *= q->shape->reach;
    const double way = 0.5 * fmax(extent(&q->feed->region, speed > 0.0 ? v : g), largest);
    if (pull > 0.0) return (sqrt(speed * speed + 2.0 * pull * way) - speed) / pull;
    return speed > 0.0 ? way / speed : HUGE_VAL;
}

dem_status scene_feed(scene *s, scene_feeder *f, double from, double until) {
    const feed_def *d = f->first->def;
    dem_status status = DEM_OK;
    for (int k = 0; k < f->source.classes; k++) s->group[f->first[k].group].fed -= f->first[k].feed->placed_mass;
    if (!isnan(d->rate)) {
        const double a = fmax(from, d->from), b = isnan(d->until) ? until : fmin(until, d->until);
        if (b > a) status = dem_feed_source_mass(&s->world, &f->source, d->rate, b - a), f->asked += d->rate * (b - a);
    } else if (!(f->done > 0.0) && from >= d->from - 1e-9 * s->tick) {
        f->done = 1.0;
        status = isnan(d->count) ? dem_fill_source_mass(&s->world, &f->source, d->mass)
                                 : dem_fill_source(&s->world, &f->source, (ptrdiff_t)d->count);
    }
    for (int k = 0; k < f->source.classes; k++) s->group[f->first[k].group].fed += f->first[k].feed->placed_mass;
    return status;
}
