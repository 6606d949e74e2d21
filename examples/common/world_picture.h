/* world_picture.h - a dem_world as a picture and as a movie, for programs.

       picture_def look = {{"small", "large"}, 2, 0.0, {0.3, 1.0, -0.4}, {960, 640}};
       draw_world(&world, &look, self.out, "scene.png");
       world_movie film = world_movie_open(self.out, "scene.mp4", &look);  // with --movie
       world_movie_add(&film, &world);                                     // at each frame; a film of NULL is none
       world_movie_close(&film); */
#ifndef WORLD_PICTURE_H
#define WORLD_PICTURE_H

#include "dem_io.h"
#include "render.h"

#include <math.h>
#include <stdio.h>

typedef struct picture_def {
    const char *names[8]; /* of the groups, for the legend */
    int n_names;
    double speed;        /* [m/s] above 0: coloured by speed up to it instead */
    double direction[3]; /* from the eye to the picture */
    int size[2];         /* width, height [pixels]; 0: 960 x 640; with option_size("size", look.size, ...) the user's */
} picture_def;

/* Whether a wall is looked through: what holds the particles, not what stands among them. */
static int is_glass(const dem_wall *wall, const dem_io_surface *s, int index, dem_vec middle) {
    dem_vec low = dem_vec3(HUGE_VAL, HUGE_VAL, HUGE_VAL), high = dem_vec3(-HUGE_VAL, -HUGE_VAL, -HUGE_VAL);
    if (wall->kind == DEM_SCREEN) return PICTURE_SOLID;
    if (wall->kind != DEM_MESH) return wall->kind == DEM_SPHERE && !wall->inside ? PICTURE_SOLID : PICTURE_GLASS;
    for (int v = 0; v < s->vertices; v++)
        for (int c = 0; c < 3 && s->wall[v] == index; c++) {
            *dem_axis_of(&low, c) = fmin(dem_axis(low, c), s->vertex[3 * v + c]);
            *dem_axis_of(&high, c) = fmax(dem_axis(high, c), s->vertex[3 * v + c]);
        }
    for (int c = 0; c < 2; c++) /* a funnel above the heap is looked through too */
        if (dem_axis(middle, c) < dem_axis(low, c) || dem_axis(middle, c) > dem_axis(high, c)) return PICTURE_SOLID;
    return PICTURE_GLASS;
}

static picture_colour colour_of(const dem_world *world, const picture_def *look, ptrdiff_t i) {
    const dem_vec v = dem_velocity(world, i);
    if (!(look->speed > 0.0)) return picture_class(world->group[i]);
    return picture_scale(sqrt(v.x * v.x + v.y * v.y + v.z * v.z) / look->speed);
}

static void put_polyhedra(picture *s, const dem_world *world, const picture_def *look) {
    dem_io_surface surface;
    if (!dem_get_shape(world, 0) || dem_io_polyhedra_of(world, &surface) != DEM_OK) return;
    for (int t = 0; t < surface.triangles; t++) {
        const int *c = &surface.triangle[3 * t];
        picture_triangle(s, &surface.vertex[3 * c[0]], &surface.vertex[3 * c[1]], &surface.vertex[3 * c[2]],
                         colour_of(world, look, surface.wall[c[0]]), PICTURE_SOLID);
    }
    dem_io_free_surface(&surface);
}

static void put_world(picture *s, const dem_world *world, const picture_def *look) {
    dem_io_surface surface;
    dem_vec middle = dem_vec3(0, 0, 0);
    int n = 0, kind[DEM_WALLS_MAX];
    put_polyhedra(s, world, look);
    for (ptrdiff_t i = 0; i < world->count; i++) {
        if (!world->alive[i]) continue;
        const dem_vec x = dem_position(world, i);
        const double at[3] = {x.x, x.y, x.z};
        if (dem_shape_of(world, i) < 0) picture_sphere(s, at, dem_radius(world, i), colour_of(world, look, i));
        middle.x += x.x, middle.y += x.y, middle.z += x.z;
        n++;
    }
    if (n) middle = dem_vec3(middle.x / n, middle.y / n, middle.z / n);
    if (dem_io_surface_of(world, &surface) != DEM_OK) return;
    for (int k = 0; k < world->walls; k++) kind[k] = is_glass(&world->wall[k], &surface, k, middle);
    for (int t = 0; t < surface.triangles; t++) {
        const int *c = &surface.triangle[3 * t], wall = surface.wall[c[0]];
        picture_triangle(s, &surface.vertex[3 * c[0]], &surface.vertex[3 * c[1]], &surface.vertex[3 * c[2]],
                         kind[wall] == PICTURE_GLASS ? picture_glass() : picture_steel(), kind[wall]);
    }
    dem_io_free_surface(&surface);
}

static picture *world_scene(const picture_def *look) {
    picture *s = picture_new(look->size[0] ? look->size[0] : 960, look->size[1] ? look->size[1] : 640);
    for (int k = 0; k < look->n_names && !(look->speed > 0.0); k++) picture_legend(s, look->names[k], picture_class(k));
    if (look->speed > 0.0) picture_bar(s, "speed [m/s]", look->speed);
    return s;
}

/* NULL without memory. */
static inline picture *picture_of_world(const dem_world *world, const picture_def *look) {
    picture *s = world_scene(look);
    char title[40];
    snprintf(title, sizeof title, "t = %.3g s", world->time);
    picture_title(s, title);
    put_world(s, world, look);
    picture_look(s, look->direction);
    return s;
}

/* As picture_write. */
static inline int draw_world(const dem_world *world, const picture_def *look, const char *folder, const char *name) {
    picture *s = picture_of_world(world, look);
    const int status = picture_write(s, folder, name);
    picture_free(s);
    return status;
}

typedef struct world_movie {
    movie *film;
    picture *s;
    const picture_def *look;
} world_movie;

static inline world_movie world_movie_open(const char *folder, const char *name, const picture_def *look) {
    /* an animation is for a page: fewer frames */
    world_movie m = {movie_open(folder, name, movie_is_animation(name) ? 12 : 25), NULL, look};
    if (m.film) m.s = world_scene(look);
    return m;
}

/* The camera stays where the first frame has put it. */
static inline void world_movie_add(world_movie *m, const dem_world *world) {
    char title[40];
    if (!m->s) return;
    const int first = picture_is_empty(m->s);
    picture_clear(m->s);
    snprintf(title, sizeof title, "t = %.2f s", world->time);
    picture_title(m->s, title);
    put_world(m->s, world, m->look);
    if (first) picture_look(m->s, m->look->direction);
    movie_add(m->film, m->s);
}

static inline void world_movie_close(world_movie *m) {
    movie_close(m->film);
    picture_free(m->s);
    m->film = NULL, m->s = NULL;
}

#endif
