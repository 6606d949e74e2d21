#define _XOPEN_SOURCE 700
#include "render.h"

#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#ifdef RIDDLE_PNG /* meson.build sets it */
#include <png.h>
#endif

#include "letters.h"
#include "output.h"
#ifdef RIDDLE_PNG
#include "apng.h"
#else
typedef struct apng apng;
#endif

enum { FINE = 2, SHADOW = 2048, CORNER_SAMPLES = 12, LEGEND = 8, NAME = 64 }; /* FINE: points a pixel along each axis */
/* Tangent of half the angle that the picture's width spans. */
static const double FIELD = 0.42;

typedef struct vec {
    double x, y, z;
} vec;
static vec make(double x, double y, double z) {
    vec v = {x, y, z};
    return v;
}
static vec of(const double a[3]) { return make(a[0], a[1], a[2]); }
static vec along(vec a, double way, vec b) { return make(a.x + way * b.x, a.y + way * b.y, a.z + way * b.z); }
static vec minus(vec a, vec b) { return along(a, -1.0, b); }
static double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec cross(vec a, vec b) { return make(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x); }
static vec unit(vec a) {
    const double length = sqrt(dot(a, a));
    return length > 0.0 ? make(a.x / length, a.y / length, a.z / length) : make(0, 0, 1);
}
static bool is_finite(vec a) { return a.x - a.x == 0.0 && a.y - a.y == 0.0 && a.z - a.z == 0.0; }

typedef struct ball {
    vec centre;
    double radius;
    picture_colour colour;
} ball;
typedef struct face {
    vec corner[3];
    picture_colour colour;
    int kind;
} face;

/* Axes of a camera (perspective, from `eye`) or of the light (parallel): right, down, forward. */
typedef struct frame {
    vec eye, right, down, forward;
} frame;

struct picture {
    int width, height;
    ball *balls;
    face *faces;
    int n_balls, balls_max, n_faces, faces_max;
    bool has_view, out_of_memory;
    frame camera;
    vec focus;
    double distance; /* of the focus from the eye */
    char title[NAME], legend[LEGEND][NAME], bar[NAME];
    picture_colour legend_colour[LEGEND];
    int legends;
    double bar_high;
};

/* What is seen through one point of the picture. */
typedef struct sample {
    float depth; /* along forward, infinite: nothing */
    float normal[3];
    picture_colour colour;
} sample;

picture_colour picture_class(int index) {
    static const picture_colour palette[8] = {{0, 114, 178}, {213, 94, 0},   {0, 158, 115}, {204, 121, 167},
                                              {230, 159, 0}, {86, 180, 233}, {122, 92, 46}, {120, 120, 120}};
    return palette[index & 7];
}

/* viridis (van der Walt & Smith 2015) at nine places */
picture_colour picture_scale(double share) {
    static const unsigned char map[9][3] = {{68, 1, 84},    {71, 44, 122},  {59, 81, 139},
                                            {44, 113, 142}, {33, 144, 141}, {39, 173, 129},
                                            {92, 200, 99},  {170, 220, 50}, {253, 231, 37}};
    const double at = !(share > 0.0) ? 0.0 : share >= 1.0 ? 8.0 : 8.0 * share;
    const int k = at >= 8.0 ? 7 : (int)at;
    unsigned char mixed[3];
    for (int c = 0; c < 3; c++) mixed[c] = (unsigned char)(map[k][c] + (at - k) * (map[k + 1][c] - map[k][c]) + 0.5);
    picture_colour colour = {mixed[0], mixed[1], mixed[2]};
    return colour;
}

picture_colour picture_glass(void) {
    picture_colour colour = {214, 219, 226};
    return colour;
}

picture_colour picture_steel(void) {
    picture_colour colour = {168, 174, 182};
    return colour;
}

/* ---- building ---- */

picture *picture_new(int width, int height) {
    picture *s = width >= 64 && width <= 4096 && height >= 64 && height <= 4096 ? calloc(1, sizeof *s) : NULL;
    if (s) s->width = width, s->height = height;
    else common_fail("a picture of %d x %d pixels cannot be drawn", width, height);
    return s;
}

void picture_free(picture *s) {
    if (!s) return;
    free(s->balls);
    free(s->faces);
    free(s);
}

int picture_is_empty(const picture *s) { return !s || (s->n_balls == 0 && s->n_faces == 0); }

void picture_clear(picture *s) {
    if (s) s->n_balls = s->n_faces = 0;
}

static bool room(picture *s, void **array, int n, int *most, size_t size) {
    if (n < *most) return true;
    const int more = 2 * *most + 1024;
    void *larger = realloc(*array, (size_t)more * size);
    if (!larger) {
        s->out_of_memory = true;
        return false;
    }
    *array = larger;
    *most = more;
    return true;
}

void picture_sphere(picture *s, const double centre[3], double radius, picture_colour colour) {
    if (!s || !is_finite(of(centre)) || !(radius > 0.0 && radius < 1e100)) return;
    void *array = s->balls;
    if (!room(s, &array, s->n_balls, &s->balls_max, sizeof *s->balls)) return;
    s->balls = array;
    ball *b = &s->balls[s->n_balls++];
    b->centre = of(centre), b->radius = radius, b->colour = colour;
}

void picture_triangle(picture *s, const double a[3], const double b[3], const double c[3], picture_colour colour,
                      int kind) {
    if (!s || !is_finite(of(a)) || !is_finite(of(b)) || !is_finite(of(c))) return;
    void *array = s->faces;
    if (!room(s, &array, s->n_faces, &s->faces_max, sizeof *s->faces)) return;
    s->faces = array;
    face *f = &s->faces[s->n_faces++];
    f->corner[0] = of(a), f->corner[1] = of(b), f->corner[2] = of(c), f->colour = colour, f->kind = kind;
}

void picture_title(picture *s, const char *text) {
    if (s) snprintf(s->title, sizeof s->title, "%s", text ? text : "");
}

void picture_legend(picture *s, const char *text, picture_colour colour) {
    if (!s || s->legends == LEGEND) return;
    snprintf(s->legend[s->legends], NAME, "%s", text ? text : "");
    s->legend_colour[s->legends++] = colour;
}

void picture_bar(picture *s, const char *text, double high) {
    if (!s) return;
    snprintf(s->bar, sizeof s->bar, "%s", text ? text : "");
    s->bar_high = high;
}

int picture_width(const picture *s) { return s ? s->width : 0; }
int picture_height(const picture *s) { return s ? s->height : 0; }

/* ---- camera ---- */

static frame axes_towards(vec direction) {
    frame f;
    f.eye = make(0, 0, 0);
    f.forward = unit(direction);
    f.right = unit(cross(f.forward, fabs(f.forward.z) > 0.999 ? make(0, 1, 0) : make(0, 0, 1)));
    f.down = cross(f.forward, f.right);
    return f;
}

/* How far the eye must stand back so that one more ball around a point is in the picture. */
static double needed(const frame *f, vec focus, vec at, double radius, double half_x, double half_y) {
    const vec d = minus(at, focus);
    const double x = fabs(dot(d, f->right)) + radius, y = fabs(dot(d, f->down)) + radius,
                 z = dot(d, f->forward) - radius;
    return fmax(x / half_x, y / half_y) - z;
}

static void include(vec at, const frame *f, double low[3], double high[3], double radius) {
    const double c[3] = {dot(at, f->right), dot(at, f->down), dot(at, f->forward)};
    for (int k = 0; k < 3; k++) low[k] = fmin(low[k], c[k] - radius), high[k] = fmax(high[k], c[k] + radius);
}

void picture_look(picture *s, const double direction[3]) {
    if (!s) return;
    frame f = axes_towards(of(direction));
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, distance = 0.0;
    for (int i = 0; i < s->n_balls; i++) include(s->balls[i].centre, &f, low, high, s->balls[i].radius);
    for (int i = 0; i < s->n_faces; i++)
        for (int k = 0; k < 3; k++) include(s->faces[i].corner[k], &f, low, high, 0.0);
    if (!(low[0] <= high[0])) low[0] = low[1] = low[2] = -1.0, high[0] = high[1] = high[2] = 1.0;
    s->focus = along(along(along(make(0, 0, 0), 0.5 * (low[0] + high[0]), f.right), 0.5 * (low[1] + high[1]), f.down),
                     0.5 * (low[2] + high[2]), f.forward);
    const double half_x = 0.92 * FIELD, half_y = 0.84 * FIELD * s->height / s->width; /* room for the scale bar */
    for (int i = 0; i < s->n_balls; i++)
        distance = fmax(distance, needed(&f, s->focus, s->balls[i].centre, s->balls[i].radius, half_x, half_y));
    for (int i = 0; i < s->n_faces; i++)
        for (int k = 0; k < 3; k++)
            distance = fmax(distance, needed(&f, s->focus, s->faces[i].corner[k], 0.0, half_x, half_y));
    if (!(distance > 0.0)) distance = 1.0;
    f.eye = along(s->focus, -distance, f.forward);
    s->camera = f;
    s->distance = distance;
    s->has_view = true;
}

/* ---- what is seen ---- */

typedef struct canvas {
    int width, height; /* fine points */
    double scale;      /* fine points for a tangent of 1 */
    sample *at;
    float *shadow; /* depth of the nearest caster, along the light */
    frame light;
    double shadow_low[2], shadow_size; /* corner and side of the square that the shadow map covers [m] */
} canvas;

static vec seen_from(const frame *f, vec at) {
    const vec d = minus(at, f->eye);
    return make(dot(d, f->right), dot(d, f->down), dot(d, f->forward));
}

/* The direction of the ray through a fine point, 1 long along forward. */
static vec ray(const canvas *c, int x, int y) {
    return make((x + 0.5 - 0.5 * c->width) / c->scale, (y + 0.5 - 0.5 * c->height) / c->scale, 1.0);
}

static int limited(double v, int high) { return v < 0.0 ? 0 : v > high ? high : (int)v; }

/* Where a triangle crosses the line at a height, widened by one; low > high: nowhere. */
static void span_of(const double x[3], const double y[3], double height, double *low, double *high) {
    *low = HUGE_VAL, *high = -HUGE_VAL;
    for (int k = 0; k < 3; k++) {
        const int next = (k + 1) % 3;
        if ((y[k] < height && y[next] < height) || (y[k] > height && y[next] > height)) continue;
        const double share = y[k] == y[next] ? 0.0 : (height - y[k]) / (y[next] - y[k]),
                     at = x[k] + share * (x[next] - x[k]);
        *low = fmin(*low, y[k] == y[next] ? fmin(x[k], x[next]) : at),
        *high = fmax(*high, y[k] == y[next] ? fmax(x[k], x[next]) : at);
    }
    *low -= 1.0, *high += 1.0;
}

static void put_sample(sample *p, double depth, vec normal, picture_colour colour) {
    p->depth = (float)depth;
    p->normal[0] = (float)normal.x, p->normal[1] = (float)normal.y, p->normal[2] = (float)normal.z;
    p->colour = colour;
}

static void draw_ball(canvas *c, const frame *camera, const ball *b) {
    const vec at = seen_from(camera, b->centre);
    if (!(at.z > 1.01 * b->radius)) return;
    const double reach = 1.2 * c->scale * b->radius / (at.z - b->radius) + 1.0; /* a sphere aside is an ellipse */
    const double mx = c->scale * at.x / at.z + 0.5 * c->width, my = c->scale * at.y / at.z + 0.5 * c->height;
    const double inside = dot(at, at) - b->radius * b->radius;
    for (int y = limited(my - reach, c->height); y < limited(my + reach + 1.0, c->height); y++)
        for (int x = limited(mx - reach, c->width); x < limited(mx + reach + 1.0, c->width); x++) {
            const vec d = ray(c, x, y);
            const double dd = dot(d, d), dc = dot(d, at), root = dc * dc - dd * inside;
            if (!(root > 0.0)) continue;
            const double t = (dc - sqrt(root)) / dd;
            sample *p = &c->at[(size_t)y * (size_t)c->width + (size_t)x];
            if (t < (double)p->depth) put_sample(p, t, unit(along(make(-at.x, -at.y, -at.z), t, d)), b->colour);
        }
}

/* Calls back for every fine point of a triangle with its depth and normal (towards the eye). */
typedef void (*plot_point)(sample *p, double depth, vec normal, picture_colour colour, double opacity);
static void draw_face(canvas *c, const frame *camera, const face *f, double opacity, plot_point put) {
    vec v[3];
    double px[3], py[3], low, high;
    for (int k = 0; k < 3; k++) {
        v[k] = seen_from(camera, f->corner[k]);
        if (!(v[k].z > 1e-9)) return;
        px[k] = c->scale * v[k].x / v[k].z + 0.5 * c->width, py[k] = c->scale * v[k].y / v[k].z + 0.5 * c->height;
    }
    const double low_y = fmin(fmin(py[0], py[1]), py[2]), high_y = fmax(fmax(py[0], py[1]), py[2]);
    vec normal = unit(cross(minus(v[1], v[0]), minus(v[2], v[0])));
    if (dot(normal, v[0]) > 0.0) normal = make(-normal.x, -normal.y, -normal.z);
    const double plane = dot(normal, v[0]);
    vec side[3]; /* planes through the eye and an edge, positive inside */
    for (int k = 0; k < 3; k++) {
        side[k] = cross(v[k], v[(k + 1) % 3]);
        if (dot(side[k], v[(k + 2) % 3]) < 0.0) side[k] = make(-side[k].x, -side[k].y, -side[k].z);
    }
    for (int y = limited(low_y - 1.0, c->height); y < limited(high_y + 2.0, c->height); y++) {
        span_of(px, py, y + 0.5, &low, &high);
        for (int x = limited(low, c->width); x < limited(high, c->width); x++) {
            const vec d = ray(c, x, y);
            const double facing = dot(normal, d);
            if (!(dot(side[0], d) >= 0.0 && dot(side[1], d) >= 0.0 && dot(side[2], d) >= 0.0) || !(facing < -1e-12))
                continue;
            put(&c->at[(size_t)y * (size_t)c->width + (size_t)x], plane / facing, normal, f->colour, opacity);
        }
    }
}

static void put_solid(sample *p, double depth, vec normal, picture_colour colour, double opacity) {
    (void)opacity;
    if (depth > 0.0 && depth < (double)p->depth) put_sample(p, depth, normal, colour);
}

static void put_glass(sample *p, double depth, vec normal, picture_colour colour, double opacity) {
    /* What touches round glass pierces its flat faces a little. */
    if (!(depth > 0.0 && depth < 1.004 * (double)p->depth)) return;
    const double bright = opacity * (0.6 + 0.4 * fabs(normal.z)), keep = 1.0 - bright;
    p->colour.red = (unsigned char)(keep * p->colour.red + bright * colour.red);
    p->colour.green = (unsigned char)(keep * p->colour.green + bright * colour.green);
    p->colour.blue = (unsigned char)(keep * p->colour.blue + bright * colour.blue);
}

/* Whether the eye sees a face of glass behind what is looked at: both are on one side of its plane. */
static bool is_behind(const picture *s, const face *f) {
    const vec n = cross(minus(f->corner[1], f->corner[0]), minus(f->corner[2], f->corner[0]));
    return (dot(n, minus(s->camera.eye, f->corner[0])) > 0.0) == (dot(n, minus(s->focus, f->corner[0])) > 0.0);
}

/* ---- light ---- */

static void shade_map(canvas *c, double x, double y, double radius, double depth, bool round) {
    const double texel = c->shadow_size / SHADOW;
    const double mx = (x - c->shadow_low[0]) / texel, my = (y - c->shadow_low[1]) / texel, reach = radius / texel + 1.0;
    for (int j = limited(my - reach, SHADOW); j < limited(my + reach + 1.0, SHADOW); j++)
        for (int i = limited(mx - reach, SHADOW); i < limited(mx + reach + 1.0, SHADOW); i++) {
            const double dx = (i + 0.5 - mx) * texel, dy = (j + 0.5 - my) * texel,
                         left = radius * radius - dx * dx - dy * dy;
            if (round && !(left > 0.0)) continue;
            float *at = &c->shadow[(size_t)j * SHADOW + (size_t)i];
            const double near = round ? depth - sqrt(left) : depth;
            if (near < (double)*at) *at = (float)near;
        }
}

static void shade_face(canvas *c, const face *f) {
    const double texel = c->shadow_size / SHADOW;
    double x[3], y[3], z[3], low, high; /* x, y in texels of the map */
    for (int k = 0; k < 3; k++) {
        const vec v = seen_from(&c->light, f->corner[k]);
        x[k] = (v.x - c->shadow_low[0]) / texel, y[k] = (v.y - c->shadow_low[1]) / texel, z[k] = v.z;
    }
    const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    if (!(fabs(area) > 0.0)) return;
    const double low_y = fmin(fmin(y[0], y[1]), y[2]), high_y = fmax(fmax(y[0], y[1]), y[2]);
    for (int j = limited(low_y, SHADOW); j < limited(high_y + 1.0, SHADOW); j++) {
        const double h = j + 0.5;
        span_of(x, y, h, &low, &high);
        for (int i = limited(low, SHADOW); i < limited(high, SHADOW); i++) {
            const double at = i + 0.5;
            const double a = ((x[1] - at) * (y[2] - h) - (x[2] - at) * (y[1] - h)) / area;
            const double b = ((x[2] - at) * (y[0] - h) - (x[0] - at) * (y[2] - h)) / area, e = 1.0 - a - b;
            float *nearest = &c->shadow[(size_t)j * SHADOW + (size_t)i];
            const double depth = a * z[0] + b * z[1] + e * z[2];
            if (a >= 0.0 && b >= 0.0 && e >= 0.0 && depth < (double)*nearest) *nearest = (float)depth;
        }
    }
}

/* The light comes over the left shoulder of who looks. */
static void cast_shadows(canvas *c, const picture *s) {
    const frame *k = &s->camera;
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    c->light = axes_towards(along(along(along(make(0, 0, 0), 0.9, k->forward), 0.5, k->right), -0.95, make(0, 0, 1)));
    for (int i = 0; i < s->n_balls; i++) include(s->balls[i].centre, &c->light, low, high, s->balls[i].radius);
    for (int i = 0; i < s->n_faces; i++)
        for (int v = 0; v < 3 && s->faces[i].kind == PICTURE_SOLID; v++)
            include(s->faces[i].corner[v], &c->light, low, high, 0.0);
    for (size_t i = 0; i < (size_t)SHADOW * SHADOW; i++) c->shadow[i] = HUGE_VALF;
    if (!(low[0] <= high[0])) low[0] = low[1] = -1.0, high[0] = high[1] = 1.0;
    c->shadow_low[0] = low[0], c->shadow_low[1] = low[1];
    c->shadow_size = fmax(fmax(high[0] - low[0], high[1] - low[1]), 1e-300);
    for (int i = 0; i < s->n_balls; i++) {
        const vec at = seen_from(&c->light, s->balls[i].centre);
        shade_map(c, at.x, at.y, s->balls[i].radius, at.z, true);
    }
    for (int i = 0; i < s->n_faces; i++)
        if (s->faces[i].kind == PICTURE_SOLID) shade_face(c, &s->faces[i]);
}

/* Share of the light that reaches a place: the mean of nine neighbours of the map. */
static double lit(const canvas *c, vec world, double bias) {
    const vec at = seen_from(&c->light, world);
    const double texel = c->shadow_size / SHADOW, u = (at.x - c->shadow_low[0]) / c->shadow_size,
                 v = (at.y - c->shadow_low[1]) / c->shadow_size;
    if (!(u > 0.0 && u < 1.0 && v > 0.0 && v < 1.0)) return 1.0; /* nobody stands between */
    const int i = limited((at.x - c->shadow_low[0]) / texel, SHADOW - 1),
              j = limited((at.y - c->shadow_low[1]) / texel, SHADOW - 1);
    double sum = 0.0;
    for (int dj = -1; dj <= 1; dj++)
        for (int di = -1; di <= 1; di++) {
            const int x = i + di < 0         ? 0
                          : i + di >= SHADOW ? SHADOW - 1
                                             : i + di,
                      y = j + dj < 0         ? 0
                          : j + dj >= SHADOW ? SHADOW - 1
                                             : j + dj;
            sum += at.z - bias - 2.0 * texel < (double)c->shadow[(size_t)y * SHADOW + (size_t)x];
        }
    return sum / 9.0;
}

/* How open the surroundings of a point are, 0 .. 1: neighbours in the picture that stand out of its surface within
   `reach` [m] take light (Mittring 2007). */
static double openness(const canvas *c, int x, int y, vec at, vec normal, double reach) {
    const double pixels = fmin(c->scale * reach / at.z, 160.0);
    uint32_t noise = (uint32_t)x * 374761393u + (uint32_t)y * 668265263u;
    noise = (noise ^ (noise >> 13)) * 1274126177u;
    const double turn = (double)(noise >> 16) / 65536.0 * 6.2831853;
    double taken = 0.0;
    for (int k = 0; k < CORNER_SAMPLES; k++) {
        const double angle = turn + 2.399963 * k, r = pixels * sqrt((k + 0.5) / CORNER_SAMPLES);
        const int i = x + (int)(r * cos(angle)), j = y + (int)(r * sin(angle));
        if (i < 0 || j < 0 || i >= c->width || j >= c->height) continue;
        const double depth = (double)c->at[(size_t)j * (size_t)c->width + (size_t)i].depth;
        if (!(depth < HUGE_VAL)) continue;
        const vec d = ray(c, i, j), to = minus(make(d.x * depth, d.y * depth, depth), at);
        const double length = sqrt(dot(to, to)) + 1e-300, up = dot(to, normal) / length;
        if (up > 0.1) taken += (up - 0.1) / (1.0 + length * length / (reach * reach));
    }
    return 1.0 - fmin(1.6 * taken / CORNER_SAMPLES, 0.85);
}

static unsigned char bounded(double v) { return (unsigned char)(v < 0.0 ? 0 : v > 255.0 ? 255 : v + 0.5); }

static void shade(const canvas *c, const picture *s, sample *to, int x, int y, double reach) {
    const sample *p = &c->at[(size_t)y * (size_t)c->width + (size_t)x];
    if (!(p->depth < HUGE_VALF)) {
        const double share = (double)y / c->height; /* a paper with a light at its head */
        to->colour.red = to->colour.green = bounded(252.0 - 22.0 * share),
        to->colour.blue = bounded(254.0 - 16.0 * share);
        return;
    }
    const double depth = (double)p->depth;
    const vec d = ray(c, x, y), at = make(d.x * depth, d.y * depth, depth);
    const vec n = make((double)p->normal[0], (double)p->normal[1], (double)p->normal[2]);
    const frame *k = &s->camera;
    const vec place = along(along(along(k->eye, at.x, k->right), at.y, k->down), at.z, k->forward);
    const vec normal = along(along(along(make(0, 0, 0), n.x, k->right), n.y, k->down), n.z, k->forward);
    const vec light = make(-c->light.forward.x, -c->light.forward.y, -c->light.forward.z),
              half = unit(minus(light, k->forward));
    const double facing = fmax(dot(normal, light), 0.0),
                 sun = facing > 0.0 ? facing * lit(c, along(place, 0.03 * reach, normal), 0.02 * reach) : 0.0;
    const double sky = (0.42 + 0.14 * normal.z) * openness(c, x, y, at, n, reach),
                 shine = sun > 0.0 ? pow(fmax(dot(normal, half), 0.0), 40.0) : 0.0;
    const double bright = sky + 0.64 * sun, gloss = 70.0 * shine * (sun > 0.0);
    to->colour.red = bounded(bright * p->colour.red + gloss);
    to->colour.green = bounded(bright * p->colour.green + gloss);
    to->colour.blue = bounded(bright * p->colour.blue + gloss);
}

/* ---- letters ---- */

typedef struct image {
    int width, height;
    unsigned char *rgb;
} image;

static void blend(image *m, int x, int y, double share, picture_colour colour) {
    if (x < 0 || y < 0 || x >= m->width || y >= m->height || !(share > 0.0)) return;
    unsigned char *p = &m->rgb[3 * ((size_t)y * (size_t)m->width + (size_t)x)];
    const double a = fmin(share, 1.0);
    p[0] = bounded((1.0 - a) * p[0] + a * colour.red);
    p[1] = bounded((1.0 - a) * p[1] + a * colour.green);
    p[2] = bounded((1.0 - a) * p[2] + a * colour.blue);
}

static void stroke(image *m, double x0, double y0, double x1, double y1, double width, picture_colour colour) {
    const double reach = 0.5 * width + 1.0, dx = x1 - x0, dy = y1 - y0, length2 = dx * dx + dy * dy;
    for (int y = (int)(fmin(y0, y1) - reach); y <= (int)(fmax(y0, y1) + reach); y++)
        for (int x = (int)(fmin(x0, x1) - reach); x <= (int)(fmax(x0, x1) + reach); x++) {
            const double px = x + 0.5 - x0, py = y + 0.5 - y0,
                         t = length2 > 0.0 ? fmin(fmax((px * dx + py * dy) / length2, 0.0), 1.0) : 0.0;
            blend(m, x, y, 0.5 + 0.5 * width - hypot(px - t * dx, py - t * dy), colour);
        }
}

typedef struct pen {
    image *m;
    picture_colour colour;
} pen;

static void put_ink(void *user, int x, int y, double share) {
    const pen *p = user;
    blend(p->m, x, y, share, p->colour);
}

/* x, y: left end of the line that the letters stand on. Size: height of a capital [pixels]. */
static void write_text(image *m, double x, double y, double size, const char *text, picture_colour colour) {
    pen p = {m, colour};
    const letters_target to = {put_ink, &p};
    letters_draw(&to, x, y, size, text);
}

static const picture_colour INK = {45, 48, 54};

/* As long as it would be where the middle of the scene is. */
static void draw_scale_bar(image *m, const picture *s, double size) {
    const double pixels_per_metre = 0.5 * m->width / FIELD / s->distance,
                 length = riddle_plot_round_length(0.25 * m->width / pixels_per_metre);
    const double x = 1.5 * size, y = m->height - 1.6 * size, end = x + length * pixels_per_metre;
    char text[40];
    if (length >= 1.0) snprintf(text, sizeof text, "%.0f m", length);
    else if (length >= 1e-3) snprintf(text, sizeof text, "%.0f mm", 1e3 * length);
    else snprintf(text, sizeof text, "%.3g \xC2\xB5m", 1e6 * length);
    stroke(m, x, y, end, y, 0.2 * size, INK);
    stroke(m, x, y - 0.4 * size, x, y + 0.4 * size, 0.15 * size, INK);
    stroke(m, end, y - 0.4 * size, end, y + 0.4 * size, 0.15 * size, INK);
    write_text(m, 0.5 * (x + end) - 0.5 * letters_width(text, size), y - 0.7 * size, size, text, INK);
}

static void draw_legend(image *m, const picture *s, double size) {
    double widest = 0.0;
    for (int k = 0; k < s->legends; k++) widest = fmax(widest, letters_width(s->legend[k], size));
    for (int k = 0; k < s->legends; k++) {
        const double y = 2.2 * size + 2.0 * size * k, x = m->width - widest - 1.2 * size;
        stroke(m, x - 1.4 * size, y - 0.5 * size, x - 1.4 * size, y - 0.5 * size, 1.3 * size, s->legend_colour[k]);
        write_text(m, x, y, size, s->legend[k], INK);
    }
    if (!*s->bar) return;
    char text[40];
    snprintf(text, sizeof text, "%.3g", s->bar_high);
    const double words = letters_width(s->bar, size) + 2.0 * letters_width(text, size);
    const double length = fmax(0.22 * m->width, words + size), x0 = m->width - length - 1.5 * size,
                 y = (2.4 + 2.0 * s->legends) * size;
    for (int k = 0; k < 100; k++)
        stroke(m, x0 + length * k / 100.0, y, x0 + length * (k + 1) / 100.0, y, 0.7 * size,
               picture_scale((k + 0.5) / 100.0));
    write_text(m, x0 - 0.3 * size, y + 2.0 * size, size, "0", INK);
    write_text(m, x0 + length - 0.7 * letters_width(text, size), y + 2.0 * size, size, text, INK);
    write_text(m, x0 + 0.5 * length - 0.5 * letters_width(s->bar, size), y + 2.0 * size, size, s->bar, INK);
}

/* ---- the picture ---- */

static double usual_radius(const picture *s) {
    double sum = 0.0;
    for (int i = 0; i < s->n_balls; i++) sum += s->balls[i].radius;
    return s->n_balls ? sum / s->n_balls : 0.01 * s->distance;
}

static void average(const canvas *c, image *m) {
    for (int y = 0; y < m->height; y++)
        for (int x = 0; x < m->width; x++) {
            int sum[3] = {0, 0, 0};
            for (int k = 0; k < FINE * FINE; k++) {
                const picture_colour p =
                    c->at[(size_t)(FINE * y + k / FINE) * (size_t)c->width + (size_t)(FINE * x + k % FINE)].colour;
                sum[0] += p.red, sum[1] += p.green, sum[2] += p.blue;
            }
            for (int k = 0; k < 3; k++)
                m->rgb[3 * ((size_t)y * (size_t)m->width + (size_t)x) + (size_t)k] =
                    (unsigned char)((sum[k] + FINE * FINE / 2) / (FINE * FINE));
        }
}

static void draw_scene(canvas *c, picture *s) {
    const size_t points = (size_t)c->width * (size_t)c->height;
    const double reach = 1.6 * usual_radius(s);
    for (size_t i = 0; i < points; i++) c->at[i].depth = HUGE_VALF;
    for (int i = 0; i < s->n_balls; i++) draw_ball(c, &s->camera, &s->balls[i]);
    for (int i = 0; i < s->n_faces; i++)
        if (s->faces[i].kind == PICTURE_SOLID || is_behind(s, &s->faces[i]))
            draw_face(c, &s->camera, &s->faces[i], 1.0, put_solid);
    cast_shadows(c, s);
    for (int y = 0; y < c->height; y++)
        for (int x = 0; x < c->width; x++) shade(c, s, &c->at[(size_t)y * (size_t)c->width + (size_t)x], x, y, reach);
    for (int i = 0; i < s->n_faces; i++)
        if (s->faces[i].kind == PICTURE_GLASS && !is_behind(s, &s->faces[i]))
            draw_face(c, &s->camera, &s->faces[i], 0.12, put_glass);
}

int picture_draw(picture *s, unsigned char *rgb) {
    static const double from_the_front[3] = {0.3, 1.0, -0.5};
    canvas c = {0};
    if (!s || s->out_of_memory) return -1;
    if (!s->has_view) picture_look(s, from_the_front);
    c.width = FINE * s->width, c.height = FINE * s->height;
    c.scale = 0.5 * c.width / FIELD;
    c.at = malloc((size_t)c.width * (size_t)c.height * sizeof *c.at);
    c.shadow = malloc((size_t)SHADOW * SHADOW * sizeof *c.shadow);
    if (c.at && c.shadow) {
        image m = {s->width, s->height, rgb};
        const double size = fmax(s->height / 44.0, 9.0);
        draw_scene(&c, s);
        average(&c, &m);
        draw_scale_bar(&m, s, size);
        draw_legend(&m, s, size);
        write_text(&m, 1.5 * size, 2.2 * size, size, s->title, INK);
    }
    const bool drawn = c.at && c.shadow;
    free(c.at);
    free(c.shadow);
    return drawn ? 0 : -1;
}

#ifdef RIDDLE_PNG
static void png_bytes(png_structp png, png_bytep bytes, png_size_t size) {
    if (riddle_io_write(png_get_io_ptr(png), bytes, size) != 0) png_error(png, "not written");
}
static void png_flushed(png_structp png) { (void)png; }

/* Libpng's own says the same a second time. */
static void png_failed(png_structp png, png_const_charp why) {
    (void)why;
    png_longjmp(png, 1);
}

static int write_png(const char *folder, const char *name, int width, int height, unsigned char *rgb) {
    riddle_io_file *file = riddle_io_open(folder, name);
    if (!file) return -1;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, png_failed, NULL);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info || setjmp(png_jmpbuf(png))) {
        png_destroy_write_struct(&png, &info);
        if (riddle_io_write(file, "", 0) != RIDDLE_IO_OK) return (int)riddle_io_close(file); /* which says why */
        riddle_io_discard(file);
        return common_fail("%s: the picture could not be written", name);
    }
    png_set_write_fn(png, file, png_bytes, png_flushed);
    png_set_IHDR(png, info, (png_uint_32)width, (png_uint_32)height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    for (int y = 0; y < height; y++) png_write_row(png, rgb + 3 * (size_t)y * (size_t)width);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    return (int)riddle_io_close(file);
}
#elif defined(__wasi__) /* bare pixels: the page makes the PNG */
static int write_png(const char *folder, const char *name, int width, int height, unsigned char *rgb) {
    riddle_io_file *file = riddle_io_open(folder, name);
    riddle_io_print(file, "P6\n%d %d\n255\n", width, height);
    riddle_io_write(file, rgb, 3 * (size_t)width * (size_t)height);
    return (int)riddle_io_close(file);
}
#endif

int picture_write(picture *s, const char *folder, const char *name) {
    if (!s) return -1;
#if defined(RIDDLE_PNG) || defined(__wasi__)
    unsigned char *rgb = malloc(3 * (size_t)s->width * (size_t)s->height);
    const int status = !rgb || picture_draw(s, rgb) != 0 ? common_fail("%s: out of memory", name)
                                                         : write_png(folder, name, s->width, s->height, rgb);
    free(rgb);
    return status;
#else
    (void)folder;
    common_print("%s is left out: built without libpng (Debian: libpng-dev)\n", name);
    return 1;
#endif
}

/* ---- movies ---- */

struct movie {
    FILE *pipe;
    apng *frames;                    /* of an animated PNG; NULL: the pipe to ffmpeg */
    char temporary[1000], path[900]; /* a folder that program_start has accepted, and a name; PNG: folder, name */
    int rate, width, height;
    bool failed;
};

static movie *open_png(const char *folder, const char *name, int frames_per_second) {
#ifdef RIDDLE_PNG
    movie *m = calloc(1, sizeof *m);
    if (m) m->frames = calloc(1, sizeof *m->frames);
    if (!m || !m->frames) {
        free(m);
        return NULL;
    }
    m->frames->rate = frames_per_second;
    snprintf(m->temporary, sizeof m->temporary, "%s", folder);
    snprintf(m->path, sizeof m->path, "%s", name);
    return m;
#else
    (void)folder, (void)frames_per_second;
    common_print("%s is left out: built without libpng (Debian: libpng-dev)\n", name);
    return NULL;
#endif
}

static int close_png(movie *m) {
    int status = -1;
#ifdef RIDDLE_PNG
    const bool empty = !m->failed && !m->frames->frames;
    if (m->failed) m->frames->body.failed = 1;
    status = apng_write(m->frames, m->temporary, m->path);
    if (empty) status = 0;
    free(m->frames);
#endif
    if (status) common_fail("%s: the animation could not be written", m->path);
    free(m);
    return status;
}

int movie_is_animation(const char *name) {
    const size_t length = strlen(name);
    return length > 4 && strcmp(name + length - 4, ".png") == 0;
}

movie *movie_open(const char *folder, const char *name, int frames_per_second) {
    if (movie_is_animation(name)) return open_png(folder, name, frames_per_second);
    if (system("command -v ffmpeg >/dev/null 2>&1") != 0) {
        common_print("%s is left out: ffmpeg is not installed\n", name);
        return NULL;
    }
    movie *m = calloc(1, sizeof *m);
    if (!m) return NULL;
#ifdef SIGPIPE
    signal(SIGPIPE, SIG_IGN); /* should ffmpeg end early, the movie fails and the run goes on */
#endif
    m->rate = frames_per_second;
    snprintf(m->path, sizeof m->path, "%s/%s", folder, name);
    snprintf(m->temporary, sizeof m->temporary, "%s/.%ld.%s", folder, (long)getpid(), name);
    return m;
}

/* Within single quotes for the shell. */
static void quoted(const char *text, char *to, size_t size) {
    size_t n = 0;
    for (; *text && n + 6 < size; text++) {
        if (*text == '\'') n += (size_t)snprintf(to + n, size - n, "'\\''");
        else to[n++] = *text;
    }
    to[n] = '\0';
}

static void add_png(movie *m, picture *s) {
#ifdef RIDDLE_PNG
    unsigned char *rgb = malloc(3 * (size_t)s->width * (size_t)s->height);
    m->failed = !rgb || picture_draw(s, rgb) != 0 || apng_frame(m->frames, rgb, s->width, s->height) != 0;
    free(rgb);
#else
    (void)m, (void)s;
#endif
}

void movie_add(movie *m, picture *s) {
    if (!m || !s || m->failed) return;
    if (m->frames) {
        add_png(m, s);
        return;
    }
    if (!m->pipe) {
        char file[4000], command[4400];
        quoted(m->temporary, file, sizeof file);
        m->width = s->width, m->height = s->height;
        snprintf(command, sizeof command,
                 "ffmpeg -y -loglevel error -f rawvideo -pix_fmt rgb24 -s %dx%d -r %d -i - -an "
                 "-vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2:0:0:white' -pix_fmt yuv420p -movflags +faststart '%s' </dev/stdin",
                 s->width, s->height, m->rate, file);
        m->pipe = popen(command, "w");
    }
    const size_t bytes = 3 * (size_t)m->width * (size_t)m->height;
    unsigned char *rgb = s->width == m->width && s->height == m->height ? malloc(bytes) : NULL;
    m->failed = !m->pipe || !rgb || picture_draw(s, rgb) != 0 || fwrite(rgb, 1, bytes, m->pipe) != bytes;
    free(rgb);
}

int movie_close(movie *m) {
    if (!m) return 0;
    if (m->frames) return close_png(m);
    int status = 0;
    if (m->pipe && (pclose(m->pipe) != 0 || m->failed || rename(m->temporary, m->path) != 0))
        status = common_fail("%s: the movie could not be written", m->path);
    remove(m->temporary);
    free(m);
    return status;
}
