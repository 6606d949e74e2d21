/* render.h: pictures of scenes of spheres and triangles: perspective, light from the upper left with shadows, shade in
   corners, scale bar.

       picture *s = picture_new(960, 640);
       for each sphere   picture_sphere(s, centre, radius, picture_class(group));
       for each triangle picture_triangle(s, a, b, c, picture_steel(), PICTURE_SOLID);
       // from where, once all is there; again to follow what moves
       picture_look(s, (double[3]){-0.4, 1.0, -0.5});
       picture_legend(s, "4 mm", picture_class(0));
       // by libpng; without it the picture is left out, and that is said
       picture_write(s, self.out, "scene.png");
       picture_free(s);

   A movie: movie *m = movie_open(folder, "drum.mp4", 25); then for each frame picture_clear(s), spheres and triangles
   again, movie_add(m, s); and movie_close(m). By ffmpeg; without it the movie is left out, and that is said. A name
   that ends in .png makes an animated PNG instead, by libpng, of 255 colours: for a page. Functions take the NULL that
   others return. */
#ifndef RIDDLE_RENDER_H
#define RIDDLE_RENDER_H

typedef struct picture picture;
typedef struct picture_colour {
    unsigned char red, green, blue;
} picture_colour;

enum { PICTURE_SOLID, PICTURE_GLASS }; /* glass: opaque behind what is looked at, nearly clear before it */

picture *picture_new(int width, int height); /* [pixels] 64 .. 4096 */
void picture_free(picture *s);
int picture_is_empty(const picture *s);
void picture_clear(picture *s); /* drops spheres and triangles; the view, legend and title stay */

/* z is up. Coordinates in [m]; what is not finite is left out. */
void picture_sphere(picture *s, const double centre[3], double radius, picture_colour colour);
void picture_triangle(picture *s, const double a[3], const double b[3], const double c[3], picture_colour colour,
                      int kind);

picture_colour picture_class(int index);    /* of a group: the palette of the figures */
picture_colour picture_scale(double share); /* 0 .. 1: the scale of heat maps */
picture_colour picture_steel(void);         /* of wires and what is solid */
picture_colour picture_glass(void);         /* of walls that one looks through */

/* The camera stands where all is seen when one looks into that direction. */
void picture_look(picture *s, const double direction[3]);
void picture_title(picture *s, const char *text); /* at the upper left; UTF-8, the letters of letters.h */
void picture_legend(picture *s, const char *text, picture_colour colour); /* one more row, at most 8 */
/* a scale of colours from 0 to high instead, such as "speed [m/s]" */
void picture_bar(picture *s, const char *text, double high);

int picture_write(picture *s, const char *folder,
                  const char *name); /* 0; 1 where there is no libpng, -1 on failure: one line was printed */

/* The picture as rgb[height][width][3]; returns 0, or -1 without memory. For tests and other formats. */
int picture_draw(picture *s, unsigned char *rgb);
int picture_width(const picture *s);
int picture_height(const picture *s);

typedef struct movie movie;
int movie_is_animation(const char *name); /* an animated PNG */
movie *movie_open(const char *folder, const char *name, int frames_per_second);
void movie_add(movie *m, picture *s); /* all of one size */
int movie_close(movie *m);            /* the file is whole or absent */

#endif
