/* scene_timetable.h: walls whose motion has a timetable: start, ramp, end. */
#ifndef RIDDLE_SCENE_TIMETABLE_H
#define RIDDLE_SCENE_TIMETABLE_H

#include "scene.h"

/* The factor of a timetable at a time, and its integral from 0 on. Timetable: [n][2], time [s] and factor,
   times rising. */
double timetable_factor(const scene_list *timetable, double time);
double timetable_integral(const scene_list *timetable, double time);

/* Hands the motions of all walls with a timetable to the world: at the beginning, and after a save has been read. 0, or
   -1 with the message in the file. */
int scene_set_timetables(scene *s);
/* Sets the speeds of belts for a time. */
dem_status scene_follow_timetables(scene *s, double time);

#endif
