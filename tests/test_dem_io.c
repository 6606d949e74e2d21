/* dem_io.h: surfaces lie where the walls are, moving ones too; sections show circles of the right size; files hold
   what is there. */
#define _POSIX_C_SOURCE 200809L
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
/* cmocka wants the four above first */
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "failing_allocator.h"

static int said;
#define RIDDLE_IO_FAIL(line) (said += *(line) != 0)
#include "dem_io.h"

static char path[300];

static const char *file(const char *end) {
    snprintf(path, sizeof path, "%s/riddle-dem-io.%ld%s", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp", (long)getpid(),
             end);
    return path;
}

/* Text of a file that is then removed; the caller frees it. */
static char *taken(const char *name) {
    FILE *f = fopen(name, "rb");
    assert_non_null(f);
    fseek(f, 0, SEEK_END);
    const long size = ftell(f);
    rewind(f);
    char *text = malloc((size_t)size + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, (size_t)size, f), size);
    text[size] = '\0';
    fclose(f);
    remove(name);
    return text;
}

static void start(dem_world *world, failing_allocator *memory) {
    dem_def def = dem_default_def();
    if (memory) def.allocator.fn = failing_fn, def.allocator.user = memory;
    dem_add_material(&def, 2500.0, 1e9, 0.2);
    def.gravity = dem_vec3(0, 0, 0);
    def.dt = 1e-4;
    memset(world, 0, sizeof *world);
    assert_int_equal(dem_init(world, &def, NULL), DEM_OK);
}

static dem_vec corner(const dem_io_surface *s, int v) {
    return dem_vec3(s->vertex[3 * v], s->vertex[3 * v + 1], s->vertex[3 * v + 2]);
}

/* The furthest corner of a wall from where `distance` is zero, and that there are some. */
static double worst(const dem_io_surface *s, int wall, double (*distance)(dem_vec)) {
    double most = 0.0;
    int n = 0;
    for (int v = 0; v < s->vertices; v++)
        if (s->wall[v] == wall) most = fmax(most, fabs(distance(corner(s, v)))), n++;
    assert_true(n > 2);
    return most;
}

static double area(const dem_io_surface *s, int wall) {
    double sum = 0.0;
    for (int t = 0; t < s->triangles; t++) {
        const int *c = &s->triangle[3 * t];
        if (s->wall[c[0]] != wall) continue;
        const dem_vec a = corner(s, c[0]), b = dem_io__along(corner(s, c[1]), -1.0, a),
                      d = dem_io__along(corner(s, c[2]), -1.0, a);
        const dem_vec n = dem_io__cross(b, d);
        sum += 0.5 * sqrt(dem_io__dot(n, n));
    }
    return sum;
}

static double from_floor(dem_vec x) { return x.z + 0.1; }
static double from_tube(dem_vec x) { return hypot(x.x, x.y) - 0.2; }
static double from_ball(dem_vec x) { return sqrt(x.x * x.x + x.y * x.y + (x.z - 0.5) * (x.z - 0.5)) - 0.05; }
static double from_cone(dem_vec x) { return hypot(x.x - 1.0, x.y) - (0.1 + 0.5 * (x.z - 0.2)); }

static void test_surfaces_lie_on_the_walls(void **state) {
    (void)state;
    dem_world w;
    dem_io_surface s;
    start(&w, NULL);
    dem_cone cone = dem_default_cone();
    cone.low = dem_vec3(1, 0, 0.2), cone.high = dem_vec3(1, 0, 0.4), cone.low_radius = 0.1, cone.high_radius = 0.2;
    const int floor = dem_add_plane(&w, 0, dem_vec3(0, 0, -0.1), dem_vec3(0, 0, 1));
    const int ball = dem_add_sphere_wall(&w, 0, dem_vec3(0, 0, 0.5), 0.05, 0);
    const int funnel = dem_add_cone(&w, 0, &cone);
    dem_disc disc = dem_default_disc();
    disc.centre = dem_vec3(-0.5, 0.2, 0.3), disc.normal = dem_vec3(0, 1, 1), disc.radius = 0.2, disc.hole_radius = 0.1;
    const int bottom = dem_add_disc(&w, 0, &disc);
    const int box = dem_add_box(&w, 0, dem_vec3(-1, -1, -0.1), dem_vec3(2, 1, 0.6));
    const int off = dem_add_sphere_wall(&w, 0, dem_vec3(0, 0, 50), 1.0, 0);
    const int exit = dem_add_exit(&w, dem_vec3(0, 0, -0.05), dem_vec3(0, 0, 1));
    assert_true(floor >= 0 && ball >= 0 && funnel >= 0 && bottom >= 0 && box >= 0 && off >= 0 && exit >= 0);
    dem_enable_wall(&w, off, 0);
    assert_int_equal(dem_io_surface_of(&w, &s), DEM_OK);
    assert_true(worst(&s, floor, from_floor) < 1e-12);
    assert_true(worst(&s, ball, from_ball) < 1e-12);
    assert_true(worst(&s, funnel, from_cone) < 1e-12);
    assert_true(fabs(area(&s, floor) / (3.0 * 2.0) - 1.0) < 0.02); /* the box that holds all, and a margin */
    assert_true(fabs(area(&s, ball) / (4.0 * RIDDLE_PI * 0.0025) - 1.0) < 0.01);
    assert_true(fabs(area(&s, funnel) / (RIDDLE_PI * 0.3 * hypot(0.1, 0.2)) - 1.0) < 0.01);
    assert_true(fabs(area(&s, bottom) / (RIDDLE_PI * (0.04 - 0.01)) - 1.0) < 0.01);
    for (int v = 0; v < s.vertices; v++) { /* all in the plane of the disc */
        const double *x = &s.vertex[3 * v];
        if (s.wall[v] == bottom) assert_true(fabs(x[1] - 0.2 + x[2] - 0.3) < 1e-12 && fabs(x[0] + 0.5) < 0.2 + 1e-12);
    }
    assert_true(fabs(area(&s, box) - 2.0 * (3.0 * 2.0 + 3.0 * 0.7 + 2.0 * 0.7)) < 1e-9);
    for (int v = 0; v < s.vertices; v++) assert_true(s.wall[v] != off && s.wall[v] != exit);
    dem_io_free_surface(&s);
    dem_io_free_surface(&s);
    dem_free(&w);
}

/* A plane across a cylinder is its end. */
static void test_ends_of_a_drum(void **state) {
    (void)state;
    dem_world w;
    dem_io_surface s;
    start(&w, NULL);
    const double centre[] = {0.0, 0.0, 0.5}, diameter[] = {0.1};
    const int tube = dem_add_cylinder(&w, 0, dem_vec3(0, 0, 3), dem_vec3(0, 0, 1), 0.2, 1);
    const int end = dem_add_plane(&w, 0, dem_vec3(7, 7, 0.45), dem_vec3(0, 0, 1));
    assert_int_equal(dem_add_spheres(&w, 1, centre, diameter, 0, 0), DEM_OK);
    assert_int_equal(dem_io_surface_of(&w, &s), DEM_OK);
    assert_true(worst(&s, tube, from_tube) < 1e-12);
    assert_true(worst(&s, end, from_tube) < 1e-12);
    assert_true(fabs(area(&s, tube) / (2.0 * RIDDLE_PI * 0.2 * 0.1) - 1.0) < 0.02);
    assert_true(fabs(area(&s, end) / (RIDDLE_PI * 0.04) - 1.0) < 0.01);
    dem_io_free_surface(&s);
    dem_free(&w);
}

/* What is drawn of a screen is what a sphere meets: no corner of a bar is further than half a wire from the
   nearest bar's axis. */
static void test_screen(void **state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        dem_world w;
        dem_io_surface s;
        dem_screen screen = dem_default_screen();
        start(&w, NULL);
        screen.circular = kind & 1, screen.profile = kind & 2 ? DEM_ROUND : DEM_SEMICIRCLE;
        screen.aperture = 0.008, screen.wire = 0.002, screen.half_x = 0.035, screen.half_y = 0.025;
        const int deck = dem_add_screen(&w, 0, &screen);
        assert_true(deck >= 0);
        assert_int_equal(dem_io_surface_of(&w, &s), DEM_OK);
        assert_int_equal(s.vertices, 2 * DEM_IO__BAR_SIDES * (kind & 1 ? 12 : 6 + 8));
        for (int v = 0; v < s.vertices; v++) {
            const dem_vec x = corner(&s, v);
            const double at_x = fabs(fmod(fabs(x.x), 0.01) - 0.005), at_y = fabs(fmod(fabs(x.y), 0.01) - 0.005);
            assert_true(fabs(x.z) < 0.0010001 && (kind & 2 || x.z > -1e-12));
            assert_true(fmin(at_x, at_y) < 0.0010001);
            assert_true(kind & 1 ? hypot(x.x, x.y) < 0.0361 : fabs(x.x) < 0.0361 && fabs(x.y) < 0.0261);
        }
        dem_io_free_surface(&s);
        dem_free(&w);
    }
}

static void test_moving_walls_are_drawn_where_they_are(void **state) {
    (void)state;
    dem_world w;
    dem_io_surface s;
    start(&w, NULL);
    const int box = dem_add_box(&w, 0, dem_vec3(0.5, -0.1, -0.1), dem_vec3(0.7, 0.1, 0.1));
    assert_int_equal(dem_rotate(&w, box, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1), RIDDLE_PI), DEM_OK);
    assert_int_equal(dem_run(&w, 0.5, DEM_LINEAR), DEM_OK); /* a quarter turn */
    assert_int_equal(dem_io_surface_of(&w, &s), DEM_OK);
    for (int v = 0; v < s.vertices; v++) {
        const dem_vec x = corner(&s, v);
        assert_true(fabs(fabs(x.x) - 0.1) < 1e-9 && fabs(fabs(x.y - 0.6) - 0.1) < 1e-9 && fabs(fabs(x.z) - 0.1) < 1e-9);
    }
    dem_io_free_surface(&s);
    dem_free(&w);
}

static void test_section(void **state) {
    (void)state;
    dem_world w;
    start(&w, NULL);
    const double centres[] = {0.0, 0.03, 0.0, 0.2, 0.2, 0.0, 0.05, -0.04, 0.1}, diameters[] = {0.1, 0.1, 0.1};
    dem_add_cylinder(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 1, 0), 0.3, 1);
    assert_int_equal(dem_add_spheres(&w, 3, centres, diameters, 0, 0), DEM_OK);
    riddle_plot *p = riddle_plot_new("section", 1, 1);
    riddle_plot_panel_size(p, 400.0, 400.0);
    riddle_plot_panel(p, 0, 0, "x [mm]", "z [mm]");
    riddle_plot_range_x(p, -400.0, 400.0);
    riddle_plot_range_y(p, -400.0, 400.0);
    assert_int_equal(dem_io_section(&w, p, dem_vec3(0, 0, 0), dem_vec3(0, -1, 0), dem_vec3(1, 0, 0), NULL, 0), DEM_OK);
    assert_int_equal(riddle_plot_write(p, NULL, file(".svg")), RIDDLE_IO_OK);
    char *text = taken(path), *at = text;
    const double radius[] = {20.0, 15.0}; /* half a millimetre a point; the second sphere does not reach the plane */
    for (int i = 0; i < 2; i++) {
        double cx, cy, r;
        at = strstr(at + 1, "<circle");
        assert_non_null(at);
        assert_int_equal(sscanf(at, "<circle cx=\"%lf\" cy=\"%lf\" r=\"%lf\"", &cx, &cy, &r), 3);
        assert_true(fabs(r - radius[i]) < 0.01);
    }
    assert_null(strstr(at + 1, "<circle"));
    assert_non_null(strstr(at, "M")); /* the drum */
    free(text);
    p = riddle_plot_new(NULL, 1, 1);
    assert_int_equal(dem_io_section(&w, p, dem_vec3(0, 0, 0), dem_vec3(0, 0, 0), dem_vec3(1, 0, 0), NULL, 0),
                     DEM_BAD_ARGUMENT);
    assert_int_equal(dem_io_section(&w, p, dem_vec3(0, 0, 0), dem_vec3(1, 0, 0), dem_vec3(2, 0, 0), NULL, 0),
                     DEM_BAD_ARGUMENT);
    assert_int_equal(dem_io_section(&w, p, dem_vec3(0, 0, 0), dem_vec3((double)NAN, 0, 0), dem_vec3(1, 0, 0), NULL, 0),
                     DEM_BAD_ARGUMENT);
    assert_int_equal(dem_io_section(&w, p, dem_vec3(0, (double)NAN, 0), dem_vec3(0, 1, 0), dem_vec3(1, 0, 0), NULL, 0),
                     DEM_BAD_ARGUMENT);
    riddle_plot_free(p);
    dem_free(&w);
}

static int count_of(const char *text, const char *part) {
    int n = 0;
    for (const char *at = text; (at = strstr(at, part)) != NULL; at++) n++;
    return n;
}

/* The figure of a section through z = 0, seen from below y; the caller frees the text. */
static char *section_of(const dem_world *w, const char *const *names, int n_names) {
    riddle_plot *p = riddle_plot_new(NULL, 1, 1);
    assert_int_equal(dem_io_section(w, p, dem_vec3(0, 0, 0), dem_vec3(0, -1, 0), dem_vec3(1, 0, 0), names, n_names),
                     DEM_OK);
    assert_int_equal(riddle_plot_write(p, NULL, file(".svg")), RIDDLE_IO_OK);
    return taken(path);
}

/* Groups have any numbers, and any number of them; each sphere is drawn once, in the colour of its group's
   last three bits. */
static void test_groups_of_any_number(void **state) {
    (void)state;
    static const int group[] = {-5, INT_MIN, INT_MAX, 2000000000, 3, 8, -1, 0};
    static const char *const names[] = {"zero", "one", NULL, "three"};
    dem_world w;
    start(&w, NULL);
    for (int i = 0; i < 8; i++) {
        const double centre[] = {0.1 * i, 0.0, 0.0}, diameter[] = {0.1};
        assert_int_equal(dem_add_spheres(&w, 1, centre, diameter, 0, group[i]), DEM_OK);
    }
    char *text = section_of(&w, NULL, 0);
    assert_int_equal(count_of(text, "<circle"), 8);
    assert_int_equal(count_of(text, "<radialGradient"), 3); /* colours 0, 3 and 7 */
    free(text);
    text = section_of(&w, NULL, INT_MAX); /* no names, no loop over them */
    assert_int_equal(count_of(text, "<circle"), 8);
    free(text);
    text = section_of(&w, names, 4);
    assert_int_equal(count_of(text, "<circle"), 8 + 3); /* three in the legend */
    free(text);
    dem_free(&w);
    start(&w, NULL);
    enum { MANY = 10000 };
    for (int i = 0; i < MANY; i++) {
        const double centre[] = {0.01 * (i % 100), 0.0, 0.01 * (double)(i / 100)}, diameter[] = {0.01};
        assert_int_equal(dem_add_spheres(&w, 1, centre, diameter, 0, 7919 * i), DEM_OK);
    }
    text = section_of(&w, NULL, 0);
    assert_int_equal(count_of(text, "<circle"), MANY);
    assert_int_equal(count_of(text, "<radialGradient"), 8); /* not one of each group */
    free(text);
    dem_free(&w);
}

/* Every gradient that a figure uses is defined in it, also that of a named group of which nothing is cut. */
static void test_legend_of_what_is_not_cut(void **state) {
    (void)state;
    static const char *const names[] = {"small", "coarse"};
    dem_world w;
    start(&w, NULL);
    const double centres[] = {0.0, 0.0, 0.0, 0.0, 1.0, 0.0}, diameter[] = {0.1};
    for (int i = 0; i < 2; i++) assert_int_equal(dem_add_spheres(&w, 1, centres + 3 * i, diameter, 0, i), DEM_OK);
    char *text = section_of(&w, names, 2);
    int used = 0;
    for (const char *at = text; (at = strstr(at, "url(#ball")) != NULL; at++, used++) {
        char id[30];
        snprintf(id, sizeof id, "id=\"%.10s\"", at + strlen("url(#"));
        assert_non_null(strstr(text, id));
    }
    assert_true(used >= 3);
    free(text);
    dem_free(&w);
}

/* A floor is drawn before anything lies on it, the sides of a box up to where they meet; what is far away does not make
   the rest small. */
static void test_planes_beside_the_particles(void **state) {
    (void)state;
    const double centre[] = {0.0, 0.0, 0.02}, diameter[] = {0.01};
    const dem_vec at[] = {{0, 0, 0}, {-0.03, 0, 0}, {0, 0, 1}, {0.03, 0, 0.02}},
                  normal[] = {{0, 0, 1}, {1, 0, 0}, {0, 0, -1}, {-1, 0, 1}};
    dem_world w;
    dem_io_surface s;
    dem_vec low, high;
    start(&w, NULL);
    assert_int_equal(dem_add_spheres(&w, 1, centre, diameter, 0, 0), DEM_OK);
    for (int k = 0; k < 4; k++) assert_int_equal(dem_add_plane(&w, 0, at[k], normal[k]), k);
    assert_int_equal(dem_io_surface_of(&w, &s), DEM_OK);
    double size[4] = {0};
    for (int k = 0; k < 4; k++) size[k] = area(&s, k);
    for (int v = 0; v < s.vertices; v++) {
        const int k = s.wall[v];
        assert_true(k != 2 && fabs(dem_io__dot(dem_io__along(corner(&s, v), -1.0, at[k]), normal[k])) < 1e-12);
    }
    assert_true(size[0] > 0.04 * 0.01 && size[1] > 0.025 * 0.01); /* they meet in a corner */
    assert_true(size[2] == 0.0 && size[3] > 0.01 * 0.01);         /* the roof is too far; the slope's shadow */
    dem_io_free_surface(&s);
    dem_io_bounds(&w, &low, &high);
    assert_true(fabs(low.z - 0.015) < 1e-15 && fabs(high.z - 0.025) < 1e-15); /* as documented: planes are not in it */
    dem_free(&w);
}

/* Names of any length: written whole, or refused with a line. */
static void test_names_of_series(void **state) {
    (void)state;
    dem_world w;
    start(&w, NULL);
    const double centre[] = {0.0, 0.0, 0.05}, diameter[] = {0.1};
    dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
    assert_int_equal(dem_add_spheres(&w, 1, centre, diameter, 0, 0), DEM_OK);
    static const int length[] = {293, 299, 310, 500, 991, 1000, 3000}; /* those above 990 are refused */
    for (int k = 0; k < 7; k++) {
        char name[3001], frame[3400], home[300];
        snprintf(home, sizeof home, "%s", file(""));
        memset(name, 'b', sizeof name);
        for (int i = 150; i < length[k]; i += 150) name[i] = '/';
        name[length[k]] = '\0';
        said = 0;
        dem_io_series series = dem_io_open(home, name);
        assert_true((series.particles != NULL) == (k < 4) && (said == 0) == (k < 4));
        assert_int_equal(dem_io_add(&series, &w), k < 4 ? RIDDLE_IO_OK : RIDDLE_IO_BAD_ARGUMENT);
        assert_int_equal(dem_io_close(&series), k < 4 ? RIDDLE_IO_OK : RIDDLE_IO_BAD_ARGUMENT);
        static const char *const ending[] = {"_0000.vtp", "_walls_0000.vtp", ".pvd", "_walls.pvd"};
        for (int e = 0; e < 4 && k < 4; e++) {
            snprintf(frame, sizeof frame, "%s/%s%s", home, name, ending[e]);
            char *text = taken(frame);
            assert_true(e > 1 || (strstr(text, "\"diameter_m\"") != NULL) == (e == 0));
            assert_true(e < 2 || count_of(text, "<DataSet") == 1);
            free(text);
        }
        snprintf(frame, sizeof frame, "%s/%s", home, name);
        for (char *slash; (slash = strrchr(frame, '/')) != NULL && strlen(frame) > strlen(home);)
            *slash = '\0', rmdir(frame);
    }
    dem_free(&w);
}

/* Of a frame that failed the index lists nothing, not even the file that an older run has left; the parts
   count alike. */
static void test_a_frame_that_fails(void **state) {
    (void)state;
    dem_world w;
    char home[300], name[400];
    start(&w, NULL);
    const double centre[] = {0.0, 0.0, 0.05}, diameter[] = {0.1};
    dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(0, 0, 1));
    assert_int_equal(dem_add_spheres(&w, 1, centre, diameter, 0, 0), DEM_OK);
    snprintf(home, sizeof home, "%s", file(""));
    for (int run = 0; run < 2; run++) { /* the second over the files of the first */
        dem_io_series series = dem_io_open(home, "s");
        for (int k = 0; k < 4; k++) {
            snprintf(name, sizeof name, "%s/s%s_000%d.vtp", home, k == 2 ? "_walls" : "", k);
            const int fails = k == 1 || k == 2;
            /* a folder of that name cannot be replaced */
            if (fails) remove(name), assert_int_equal(mkdir(name, 0777), 0);
            assert_int_equal(dem_io_add(&series, &w), fails ? RIDDLE_IO_NOT_WRITTEN : RIDDLE_IO_OK);
            if (fails) rmdir(name);
            if (fails) assert_int_equal(dem_io_walls(&w, NULL, name), RIDDLE_IO_OK); /* looks like an older one */
        }
        assert_int_equal(dem_io_close(&series), RIDDLE_IO_OK);
        snprintf(name, sizeof name, "%s/s.pvd", home);
        char *text = taken(name);
        assert_true(count_of(text, "<DataSet") == 3 && strstr(text, "s_0001.vtp") == NULL);
        free(text);
        snprintf(name, sizeof name, "%s/s_walls.pvd", home);
        text = taken(name);
        assert_true(count_of(text, "<DataSet") == 2 && strstr(text, "\"s_walls_0000.vtp") &&
                    strstr(text, "\"s_walls_0003.vtp"));
        free(text);
    }
    for (int k = 0; k < 8; k++) {
        snprintf(name, sizeof name, "%s/s%s_000%d.vtp", home, k & 1 ? "_walls" : "", k / 2);
        remove(name);
    }
    assert_int_equal(rmdir(home), 0);
    dem_free(&w);
}

static void test_memory_and_wrong_calls(void **state) {
    (void)state;
    dem_world w;
    dem_io_surface s;
    failing_allocator memory;
    failing_init(&memory);
    start(&w, &memory);
    const double centre[] = {0.0, 0.0, 0.5}, diameter[] = {0.1};
    assert_int_equal(dem_add_spheres(&w, 1, centre, diameter, 0, 0), DEM_OK);
    assert_true(dem_add_box(&w, 0, dem_vec3(0, 0, 0), dem_vec3(1, 1, 1)) >= 0);
    riddle_plot *p = riddle_plot_new(NULL, 1, 1);
    memory.fail_at = memory.calls;
    assert_int_equal(dem_io_surface_of(&w, &s), DEM_OUT_OF_MEMORY);
    assert_int_equal(dem_io_particles(&w, NULL, file(".vtp")), RIDDLE_IO_NO_MEMORY);
    assert_int_equal(dem_io_walls(&w, NULL, path), RIDDLE_IO_NO_MEMORY);
    assert_int_equal(dem_io_section(&w, p, dem_vec3(0, 0, 0), dem_vec3(1, 0, 0), dem_vec3(0, 1, 0), NULL, 0),
                     DEM_OUT_OF_MEMORY);
    memory.fail_at = memory.calls + 1; /* the second block of each */
    assert_int_equal(dem_io_walls(&w, NULL, path), RIDDLE_IO_NO_MEMORY);
    assert_int_equal(access(path, F_OK), -1);
    riddle_plot_free(p);
    dem_free(&w);
    assert_int_equal(failing_live(&memory), 0);
    assert_int_equal(dem_io_surface_of(NULL, &s), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_io_surface_of(&w, NULL), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_io_surface_of(&w, &s), DEM_BAD_ARGUMENT); /* freed */
    assert_int_equal(dem_io_particles(NULL, NULL, path), RIDDLE_IO_BAD_ARGUMENT);
    assert_int_equal(dem_io_add(NULL, &w), RIDDLE_IO_BAD_ARGUMENT);
    assert_int_equal(dem_io_close(NULL), RIDDLE_IO_BAD_ARGUMENT);
    dem_io_free_surface(NULL);
    said = 0;
    dem_io_series none = dem_io_open(NULL, NULL);
    assert_true(said > 0);
    assert_int_equal(dem_io_add(&none, &w), RIDDLE_IO_BAD_ARGUMENT);
}

/* An empty world, and one with a wall and no particle, give files that are whole. */
static void test_empty(void **state) {
    (void)state;
    dem_world w;
    start(&w, NULL);
    for (int walls = 0; walls < 2; walls++) {
        if (walls) dem_add_plane(&w, 0, dem_vec3(0, 0, 0), dem_vec3(1, 2, 3));
        assert_int_equal(dem_io_particles(&w, NULL, file(".vtp")), RIDDLE_IO_OK);
        free(taken(path));
        assert_int_equal(dem_io_walls(&w, NULL, path), RIDDLE_IO_OK);
        char *text = taken(path);
        assert_non_null(strstr(text, walls ? "NumberOfPolys=\"" : "NumberOfPolys=\"0\""));
        free(text);
    }
    dem_free(&w);
}

/* A series of a world with shapes has a third index, with as many frames. */
static void series_of_polyhedra(const dem_world *w) {
    char name[100], *text;
    snprintf(name, sizeof name, "test_dem_io_series_%d", (int)getpid());
    dem_io_series series = dem_io_open(NULL, name);
    assert_int_equal(dem_io_add(&series, w), RIDDLE_IO_OK);
    assert_int_equal(dem_io_add(&series, w), RIDDLE_IO_OK);
    assert_int_equal(dem_io_close(&series), RIDDLE_IO_OK);
    static const char *const endings[] = {".pvd", "_walls.pvd", "_polyhedra.pvd"};
    static const char *const frames[] = {"", "_walls", "_polyhedra"};
    for (int k = 0; k < 3; k++) {
        char file_name[200];
        for (int frame = 0; frame < 2; frame++) {
            snprintf(file_name, sizeof file_name, "%s%s_%04d.vtp", name, frames[k], frame);
            text = taken(file_name);
            assert_true((strstr(text, "\"particle\"") != NULL) == (k == 2));
            free(text);
        }
        snprintf(file_name, sizeof file_name, "%s%s", name, endings[k]);
        text = taken(file_name);
        assert_non_null(strstr(text, "_0001.vtp"));
        assert_null(strstr(text, "_0002.vtp"));
        free(text);
    }
}

/* The surface of a brick and of another polyhedron, turned, is closed, faces outwards and holds their volume but
   for the edges. */
static void test_polyhedra(void **state) {
    (void)state;
    dem_world w;
    dem_io_surface s;
    dem_convex shape[2];
    dem_def def = dem_default_def();
    const double tall[15] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1.5}, at[6] = {0, 0, 0, 5, 1, 2},
                 turn[4] = {0.3, -0.5, 0.7, 0.2};
    dem_add_material(&def, 1000.0, 1e7, 0.3);
    assert_int_equal(dem_init(&w, &def, NULL), DEM_OK);
    assert_int_equal(dem_io_polyhedra_of(&w, &s), DEM_OK);
    assert_int_equal(s.triangles, 0);
    dem_io_free_surface(&s);
    assert_int_equal(dem_make_brick(&shape[0], dem_vec3(1, 1, 2.08), 0.02, NULL), DEM_OK);
    assert_int_equal(dem_make_convex(&shape[1], 5, tall, 0.02, NULL), DEM_OK);
    for (int k = 0; k < 2; k++) {
        assert_int_equal(dem_add_shape(&w, &shape[k]), k);
        assert_int_equal(dem_add_convex(&w, k, 1, at + 3 * k, turn, 0, 0), DEM_OK);
    }
    assert_int_equal(dem_io_polyhedra_of(&w, &s), DEM_OK);
    double volume[2] = {0, 0};
    dem_vec area[2] = {{0, 0, 0}, {0, 0, 0}};
    for (int k = 0; k < s.triangles; k++) {
        const int *t = s.triangle + 3 * k, owner = s.wall[t[0]];
        const dem_vec o = dem_position(&w, owner), a = dem__sub(corner(&s, t[0]), o), b = dem__sub(corner(&s, t[1]), o),
                      c = dem__sub(corner(&s, t[2]), o);
        const double part = dem__dot(a, dem__cross(b, c)) / 6.0;
        assert_true(part > 0.0);
        volume[owner] += part;
        area[owner] = dem__add(area[owner], dem__cross(dem__sub(b, a), dem__sub(c, a)));
    }
    for (int k = 0; k < 2; k++) {
        assert_true(volume[k] < shape[k].volume && volume[k] > 0.97 * shape[k].volume);
        assert_true(dem__length(area[k]) < 1e-12);
    }
    dem_io_free_surface(&s);
    series_of_polyhedra(&w);
    /* a wedge is drawn as it was given: on its large face */
    const double wedge[18] = {0, 0, 0, 3, 0, 0, 0, 1, 0, 3, 1, 0, 0, 0, 2, 0, 1, 2};
    assert_int_equal(dem_make_convex(&shape[1], 6, wedge, 0.02, NULL), DEM_OK);
    const double place[3] = {shape[1].centroid.x, shape[1].centroid.y, shape[1].centroid.z};
    assert_int_equal(dem_add_convex(&w, dem_add_shape(&w, &shape[1]), 1, place, NULL, 0, 0), DEM_OK);
    assert_int_equal(dem_io_polyhedra_of(&w, &s), DEM_OK);
    int on_floor = 0;
    for (int k = 0; k < s.vertices; k++) {
        if (s.wall[k] != 2) continue;
        const dem_vec v = corner(&s, k);
        assert_true(v.x > -1e-12 && v.x < 3.0 && v.y > -1e-12 && v.y < 1.0 + 1e-12 && v.z > -1e-12 && v.z < 2.0);
        on_floor += v.z < 1e-12;
    }
    assert_int_equal(on_floor, 4);
    dem_io_free_surface(&s);
    assert_int_equal(dem_io_polyhedra_of(NULL, &s), DEM_BAD_ARGUMENT);
    assert_int_equal(dem_io_polyhedra_of(&w, NULL), DEM_BAD_ARGUMENT);
    dem_free(&w);
}

/* Whatever a caller forgets is told or left out; nothing reads through a null pointer. */
static void test_null_pointers(void **state) {
    (void)state;

    riddle_io_array none;
    memset(&none, 0, sizeof none);
    char b[10];
    double x[3] = {0, 1, 2};
    int ii[3] = {0, 1, 2};
    const char *names[3] = {"a", NULL, "c"};
    riddle_io_status_text((riddle_io_status)99);
    riddle_io_open(NULL, NULL);
    riddle_io_print(NULL, "x");
    riddle_io_write(NULL, NULL, 3);
    riddle_io_row(NULL, NULL, 3);
    riddle_io_close(NULL);
    riddle_io_discard(NULL);
    riddle_io_file *f = riddle_io_open(NULL, "/dev/null");
    riddle_io_write(f, NULL, 0);
    riddle_io_write(f, NULL, 3);
    riddle_io_row(f, NULL, 0);
    riddle_io_row(f, NULL, 3);
    riddle_io_row(f, x, -3);
    riddle_io_close(f);
    riddle_io_make_folder(NULL, NULL, 0);
    riddle_io_make_folder(NULL, b, sizeof b);
    riddle_io_can_write(NULL, NULL, 0);
    riddle_io_can_write(NULL, b, 10);
    riddle_io_path(NULL, 0, NULL, NULL);
    riddle_io_path(b, 10, NULL, NULL);
    riddle_io_path(b, 10, "averyveryverylong", "x");
    riddle_io_path(b, 0, "a", "b");
    riddle_io_scalar(NULL, NULL);
    riddle_io_vector3(NULL, x, NULL, x);
    riddle_io_points(NULL, NULL, 1, none, NULL, 1);
    riddle_io_points(NULL, "/dev/null", 1, none, NULL, 0);
    riddle_io_points(NULL, "/dev/null", 1, riddle_io_vector("p", x), NULL, 1);
    riddle_io_points(NULL, "/dev/null", 1, riddle_io_vector("p", x), &none, 1);
    riddle_io_points(NULL, "/dev/null", -1, riddle_io_vector("p", x), NULL, 0);
    riddle_io_points(NULL, "/dev/null", 1, riddle_io_vector(NULL, x), NULL, 0);
    {
        riddle_io_array a = riddle_io_scalar(NULL, x);
        riddle_io_points(NULL, "/dev/null", 1, riddle_io_vector("p", x), &a, 1);
    }
    riddle_io_lines(NULL, "/dev/null", 1, riddle_io_vector("p", x), 1, NULL, NULL, NULL, 0);
    riddle_io_polygons(NULL, "/dev/null", 1, riddle_io_vector("p", x), 1, NULL, ii, NULL, 0);
    riddle_io_lines(NULL, "/dev/null", 1, riddle_io_vector("p", x), 1, ii, NULL, NULL, 0);
    {
        int e[1] = {3}, c[3] = {0, 5, -1};
        riddle_io_lines(NULL, "/dev/null", 1, riddle_io_vector("p", x), 1, e, c, NULL, 0);
    }
    riddle_io_cells(NULL, "/dev/null", NULL, NULL, NULL, NULL, 0);
    {
        int n[3] = {1, 1, 1};
        riddle_io_cells(NULL, "/dev/null", n, NULL, x, NULL, 0);
        riddle_io_cells(NULL, "/dev/null", n, x, NULL, NULL, 1);
        riddle_io_cells(NULL, "/dev/null", n, x, x, &none, 1);
        int big[3] = {2000000000, 2000000000, 2000000000};
        riddle_io_array a = riddle_io_scalar("s", x);
        riddle_io_cells(NULL, "/dev/null", big, x, x, &a, 1);
    }
    riddle_io_series_open(NULL, NULL);
    riddle_io_series_name(NULL, 0);
    riddle_io_series_name_as(NULL, 0, NULL);
    riddle_io_series_close(NULL);
    riddle_plot *p = riddle_plot_new(NULL, 1, 1);
    riddle_plot *q[2];
    q[0] = p;
    q[1] = NULL;
    riddle_plot_new("x", 0, -1);
    riddle_plot_new("x", 99, 1);
    for (int k = 0; k < 2; k++) {
        riddle_plot *t = q[k];
        riddle_plot_panel_size(t, -1, 0.0 / 0.0);
        riddle_plot_panel(t, 9, -1, NULL, NULL);
        riddle_plot_panel(t, 0, 0, NULL, NULL);
        riddle_plot_title(t, NULL);
        riddle_plot_log_x(t);
        riddle_plot_log_y(t);
        riddle_plot_range_x(t, 0.0 / 0.0, 1);
        riddle_plot_range_y(t, 2, 1);
        riddle_plot_range_y(t, -1, 1);
        riddle_plot_equal(t);
        riddle_plot_line(t, NULL, NULL, NULL, 3);
        riddle_plot_line(t, NULL, x, x, 3);
        riddle_plot_line(t, NULL, x, x, -3);
        riddle_plot_points(t, NULL, x, NULL, 3);
        riddle_plot_band(t, NULL, x, NULL, x, 3);
        riddle_plot_error_bars(t, NULL, x, x, NULL, 3);
        riddle_plot_discs(t, NULL, NULL, NULL, NULL, 3);
        riddle_plot_discs(t, NULL, x, x, x, 3);
        riddle_plot_bars(t, NULL, NULL, x, 3);
        riddle_plot_bars(t, NULL, names, x, 3);
        riddle_plot_bars(t, NULL, names, NULL, 3);
        riddle_plot_heat(t, NULL, NULL, 1, 3, 0, 1, 0, 1);
        riddle_plot_heat(t, NULL, x, 1, 3, 0, 1, 0, 0.0 / 0.0);
        riddle_plot_heat(t, NULL, x, 0, -3, 0, 1, 0, 1);
        riddle_plot_heat_range(t, 1, 1);
        riddle_plot_style(t, -1, -99);
        riddle_plot_style(t, 1 << 30, 99999999);
        riddle_plot_horizontal(t, NULL, 0.0 / 0.0);
        riddle_plot_vertical(t, NULL, 1e308);
        riddle_plot_text(t, 0, 0, NULL);
        riddle_plot_text_share(t, 0.0 / 0.0, 0, NULL);
        riddle_plot_write(t, NULL, k ? NULL : "/dev/null");
    }
    riddle_plot_free(NULL);
    riddle_plot_write(riddle_plot_new("t", 1, 1), NULL, NULL);
    riddle_io_table t = riddle_io_table_begin(NULL);
    riddle_io_table_cell(&t, "%d", 1);
    riddle_io_table_end(&t, NULL);
    riddle_io_table_cell(NULL, "%d", 1);
    riddle_io_table_end(NULL, NULL);
    t = riddle_io_table_begin("a|b");
    riddle_io_table_cell(&t, "x");
    riddle_io_table_end(&t, NULL);
    riddle_io_progress_begin(NULL, NULL, 1);
    riddle_io_progress_update(NULL, 1);
    riddle_io_progress_end(NULL, NULL);
    riddle_io_progress bar;
    riddle_io_progress_begin(&bar, NULL, 0.0 / 0.0);
    riddle_io_progress_update(&bar, 0.0 / 0.0);
    riddle_io_progress_update(&bar, -1);
    riddle_io_progress_end(&bar, NULL);
    dem_vec a, bb;
    dem_io_bounds(NULL, &a, &bb);
    dem_world w;
    memset(&w, 0, sizeof w);
    dem_io_bounds(&w, NULL, NULL);
    dem_io_bounds(&w, &a, &bb);
    dem_io_surface s;
    memset(&s, 0, sizeof s);
    dem_io_surface_of(NULL, &s);
    dem_io_surface_of(&w, NULL);
    dem_io_surface_of(&w, &s);
    dem_io_polyhedra_of(NULL, &s);
    dem_io_polyhedra_of(&w, &s);
    dem_io_free_surface(NULL);
    dem_io_free_surface(&s);
    dem_io_particles(NULL, NULL, "/dev/null");
    dem_io_particles(&w, NULL, NULL);
    dem_io_particles(&w, NULL, "/dev/null");
    dem_io_walls(NULL, NULL, "/dev/null");
    dem_io_walls(&w, NULL, NULL);
    dem_io_polyhedra(NULL, NULL, NULL);
    dem_io_polyhedra(&w, NULL, "/dev/null");
    dem_io_series se = dem_io_open(NULL, NULL);
    dem_io_add(&se, &w);
    dem_io_add(NULL, &w);
    dem_io_add(&se, NULL);
    dem_io_close(&se);
    dem_io_close(NULL);
    memset(&se, 0, sizeof se);
    dem_io_add(&se, &w);
    dem_io_close(&se);
    dem_io_section(NULL, NULL, a, a, a, NULL, 0);
    dem_io_section(&w, NULL, a, a, a, NULL, 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_polyhedra),
        cmocka_unit_test(test_surfaces_lie_on_the_walls),
        cmocka_unit_test(test_ends_of_a_drum),
        cmocka_unit_test(test_screen),
        cmocka_unit_test(test_moving_walls_are_drawn_where_they_are),
        cmocka_unit_test(test_section),
        cmocka_unit_test(test_groups_of_any_number),
        cmocka_unit_test(test_legend_of_what_is_not_cut),
        cmocka_unit_test(test_planes_beside_the_particles),
        cmocka_unit_test(test_names_of_series),
        cmocka_unit_test(test_a_frame_that_fails),
        cmocka_unit_test(test_memory_and_wrong_calls),
        cmocka_unit_test(test_null_pointers),
        cmocka_unit_test(test_empty),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
