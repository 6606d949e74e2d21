/* scene_timetable.c: see scene_timetable.h */
#include "scene_timetable.h"

#include <math.h>
#include <string.h>

#include "scene_walls.h"

double timetable_factor(const scene_list *t, double time) {
    const double *p = t->item;
    if (time <= p[0]) return p[1];
    for (int k = 1; k < t->n; k++, p += 2)
        if (time < p[2]) return p[1] + (p[3] - p[1]) * ((time - p[0]) / (p[2] - p[0]));
    return p[1];
}

double timetable_integral(const scene_list *t, double time) {
    const double *p = t->item;
    double sum = 0.0;
    if (time <= p[0]) return time * p[1];
    sum = p[0] * p[1];
    for (int k = 1; k < t->n; k++, p += 2) {
        const double end = fmin(time, p[2]);
        sum += (end - p[0]) * 0.5 * (p[1] + timetable_factor(t, end));
        if (time <= p[2]) return sum;
    }
    return sum + (time - p[0]) * p[1];
}

static void pose(void *user, double time, dem_pose *out) {
    const wall_def *w = user;
    const double gone = timetable_integral(&w->timetable, time), now = timetable_factor(&w->timetable, time);
    double shift[3] = {0.0, 0.0, 0.0};
    if (w->rotate.part.where) {
        const dem_vec a = scene_vec(w->rotate.axis);
        const double by = w->rotate.speed * gone / sqrt(a.x * a.x + a.y * a.y + a.z * a.z);
        out->turn = dem_vec3(by * a.x, by * a.y, by * a.z);
    }
    for (int c = 0; c < 3; c++) {
        const vibration *v = &w->vibrate;
        if (w->move.part.where) shift[c] += w->move.velocity[c] * gone;
        if (!v->part.where || v->amplitude[c] == 0.0) continue;
        const double turns = v->frequency * time, angle = 2.0 * RIDDLE_PI * (turns - floor(turns)) + v->phase[c];
        shift[c] += now * v->amplitude[c] * (riddle_sin(angle) - riddle_sin(v->phase[c]));
    }
    out->shift = scene_vec(shift);
}

static int moves(const wall_def *w) { return w->rotate.part.where || w->move.part.where || w->vibrate.part.where; }

int scene_set_timetables(scene *s) {
    const wall_def *w = s->def->walls.item;
    for (int k = 0; k < s->def->walls.n; k++, w++) {
        const tree *at = fields_where(&w->part, "timetable");
        if (w->timetable.n == 0) continue;
        if (w->piston.part.where || w->rotor.part.where || (!moves(w) && !w->belt.part.where))
            return tree_fail(s->file, at, "timetable: wall %.60s has no rotate, move, vibrate or belt", w->part.name);
        if (!moves(w)) continue;
        const double *axis = w->rotate.axis;
        if (w->rotate.part.where && !(axis[0] * axis[0] + axis[1] * axis[1] + axis[2] * axis[2] > 0.0))
            return tree_fail(s->file, w->rotate.part.where, "axis: it has no direction");
        const dem_vec centre = w->rotate.part.where ? scene_vec(w->rotate.centre) : dem_vec3(0.0, 0.0, 0.0);
        const dem_status status = dem_prescribe(&s->world, s->wall_of[k], centre, pose, (void *)(uintptr_t)w);
        if (status != DEM_OK) return tree_fail(s->file, at, "timetable: %s", dem_status_text(status));
    }
    return 0;
}

dem_status scene_follow_timetables(scene *s, double time) {
    const wall_def *w = s->def->walls.item;
    dem_status status = DEM_OK;
    for (int k = 0; k < s->def->walls.n && status == DEM_OK; k++, w++)
        if (w->timetable.n > 0 && w->belt.part.where)
            status = scene_set_belt(s, w, s->wall_of[k], timetable_factor(&w->timetable, time));
    return status;
}
