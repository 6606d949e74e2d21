/* Pairs of polyhedra, or of a polyhedron and a sphere or a wall, that are not tested for some steps. Reads bodies
   and walls; writes pairs. Promises: a pair is skipped only while both bodies stay in flight and cannot touch in
   that time. */
#pragma once
#include "../search/narrow_phase.h"
#include "../walls/mesh_touch.h"

/* Returns whether particle i is still in the flight that began at a step. */
DEM_INLINE int dem__flies_on(const dem_world *w, ptrdiff_t i, int64_t origin) {
    return w->engine->bodies.activity[i] == DEM__FLYING && w->particle[i].origin == origin;
}
/* Returns whether a pair is skipped at a step, because it cannot touch. */
DEM_INLINE int dem__is_skipped(const dem_world *w, const dem__convex_pair *p, int64_t step) {
    if (p->skip_until <= step || !dem__flies_on(w, p->i, p->origin[0])) return 0;
    if (p->j >= 0) return dem__flies_on(w, p->j, p->origin[1]);
    const dem_wall *wall = &w->wall[-1 - p->j];
    return wall->speed_bound <= p->speed && wall->spin_bound <= p->spin;
}

/* Skips a pair for some steps, from a step on. */
DEM_INLINE void dem__skip_until(const dem_world *w, dem__convex_pair *p, int64_t step, int steps) {
    p->skip_until = step + steps;
    p->origin[0] = w->particle[p->i].origin;
    if (p->j >= 0) p->origin[1] = w->particle[p->j].origin;
}

/* Returns whether particle i moves on a parabola until it touches something. Polyhedra have no links. */
DEM_INLINE int dem__is_in_flight(const dem_world *w, ptrdiff_t i) {
    return w->engine->bodies.activity[i] == DEM__FLYING && !(w->engine->links.on && !dem__shape_of(w, i));
}
/* Returns the greatest speed of particle i relative to the centre of its clump or compound, from its rotation [m/s]; 0
   for a polyhedron alone. */
DEM_INLINE double dem__part_speed_of(const dem_world *w, ptrdiff_t i) {
    return dem__shape_of(w, i) && !dem__is_part(w, i) ? 0.0 : dem__turning_speed_of(w, i);
}
/* Returns the distance of the farthest point of a polyhedron that is within `reach` of its centre from the centre of
   its body [m]. */
DEM_INLINE double dem__reach_in_body(const dem_world *w, ptrdiff_t i, double reach) {
    return dem__is_part(w, i) ? dem__length(w->engine->bodies.offset[i]) + reach : reach;
}
/* Returns the greatest speed of the surface of particle i, or of a clump's sphere, relative to the centre of its body
   [m/s]. */
DEM_INLINE double dem__surface_speed_of(const dem_world *w, ptrdiff_t i) {
    const dem_convex *s = dem__shape_of(w, i);
    return s ? dem__turning_speed_at(w, i, dem__reach_in_body(w, i, s->reach)) : dem__turning_speed_of(w, i);
}
/* Returns the time from the origin step of particle i to a step [s]. */
DEM_INLINE double dem__flown_until(const dem_world *w, ptrdiff_t i, int64_t step) {
    return (double)(step - w->particle[i].origin) * w->engine->run.dt;
}
/* Returns the centre of particle i at a step. A polyhedron in flight needs no orientation for it; others have been
   placed. */
DEM_INLINE dem_vec dem__centre_in(const dem_world *w, ptrdiff_t i, int64_t step) {
    const double tau = dem__flown_until(w, i, step);
    if (!dem__shape_of(w, i)) return dem__at(w, i, tau);
    if (w->engine->bodies.activity[i] != DEM__FLYING) return w->engine->convex.place[i].x;
    return dem__is_part(w, i) ? dem__at(w, i, tau) : dem__centre_at(w, i, tau);
}

/* Returns whether a pair may be skipped: both particles are in flight. */
DEM_INLINE int dem__may_skip(const dem_world *w, const dem__convex_pair *p) {
    return (w->def.skip & DEM_SKIP_PAIRS) && dem__is_in_flight(w, p->i) && dem__is_in_flight(w, p->j);
}
/* Returns the velocity of the centre of particle i relative to that of j [m/s]. */
DEM_INLINE dem_vec dem__drift_between(const dem_world *w, const dem__convex_pair *p, int64_t step) {
    return dem__sub(dem__drift_at(w, p->i, dem__flown_until(w, p->i, step)),
                    dem__drift_at(w, p->j, dem__flown_until(w, p->j, step)));
}
/* Returns how fast this velocity changes [m/s2]. */
DEM_INLINE double dem__pull_between(const dem_world *w, const dem__convex_pair *p) {
    return dem__length(dem__sub(dem__centre_pull(w, p->i), dem__centre_pull(w, p->j)));
}

/* Finds whether the spheres around two particles touch at a step. If they do not, and both particles are in flight,
   skips the pair. */
static inline void dem__look_at_spheres(const dem_world *w, dem__convex_pair *p, int64_t step) {
    const double slack = 2.0 * w->engine->pairs.position_tolerance;
    const double reach = w->particle[p->i].radius + w->particle[p->j].radius + slack;
    const dem_vec d = dem__nearest_image(w, dem__sub(dem__centre_in(w, p->i, step), dem__centre_in(w, p->j, step)));
    p->is_close = dem__dot(d, d) < reach * reach;
    if (p->is_close || !dem__may_skip(w, p)) return;
    const double speed =
        dem__length(dem__drift_between(w, p, step)) + dem__part_speed_of(w, p->i) + dem__part_speed_of(w, p->j);
    dem__skip_until(w, p, step,
                    dem__steps_until(w, dem__time_to_cover(dem__length(d) - reach, speed, dem__pull_between(w, p))));
}

/* Returns a lower limit of the distance between i and all images of j but the nearest one [m]. d: from that one to
   i. */
DEM_INLINE double dem__far_images(const dem_world *w, dem_vec d) {
    double least = HUGE_VAL;
    for (int a = 0; a < 3; a++) {
        const double length = dem_axis(w->def.high, a) - dem_axis(w->def.low, a) - fabs(dem_axis(d, a));
        if (w->def.periodic[a] && length < least) least = length;
    }
    return least;
}

/* Skips two particles in flight that do not touch although the spheres around them do. d: from j to i; gap: between
   their surfaces along n, a direction from j to i, in which nothing of them is nearer. */
static inline void dem__skip_pair(const dem_world *w, dem__convex_pair *p, int64_t step, dem_vec d, double gap,
                                  dem_vec n) {
    const double slack = 2.0 * w->engine->pairs.position_tolerance;
    if (!(gap > slack) || !dem__may_skip(w, p)) return;
    const dem_vec v = dem__drift_between(w, p, step);
    const double surface_speed = dem__surface_speed_of(w, p->i) + dem__surface_speed_of(w, p->j),
                 pull = dem__pull_between(w, p);
    const double others = dem__far_images(w, d) - w->particle[p->i].radius - w->particle[p->j].radius;
    const double soonest = dem__time_to_close(gap - slack, surface_speed - dem__dot(n, v), pull),
                 other = dem__time_to_cover(others - slack, dem__length(v) + surface_speed, pull);
    dem__skip_until(w, p, step, dem__steps_until(w, other < soonest ? other : soonest));
    p->is_close = 0;
}

/* How a particle moves in the frame of a wall. */
typedef struct dem__approach {
    double speed, pull; /* speed now [m/s]; limit of its change [m/s2] */
    int most;           /* number of steps for which these hold */
} dem__approach;
/* Returns how a particle at x with velocity v and acceleration a moves relative to a wall. */
static inline dem__approach dem__approach_to(const dem_world *w, const dem_wall *wall, dem_vec x, dem_vec v,
                                             dem_vec a) {
    const double turn = DEM__RETEST_STEPS * w->engine->run.dt;
    dem__approach q;
    q.speed = dem__length(v) + wall->speed_bound, q.pull = dem__length(a), q.most = DEM__STEPS_MAX;
    if (!(wall->spin_bound > 0.0)) return q;
    q.most = DEM__RETEST_STEPS;
    if (wall->asked.drive == DEM_KINEMATIC && wall->speed_bound == 0.0 &&
        wall->spin_bound * turn < 0.02) { /* it turns uniformly */
        const dem_vec arm = dem__sub(x, wall->asked.spin_centre), spin = dem__scale(wall->spin, wall->spin_axis);
        const double bound = wall->spin_bound;
        q.speed = dem__length(dem__sub(v, dem__cross(spin, arm)));
        q.pull = 1.05 * (q.pull + bound * (bound * dem__length(arm) +
                                           2.02 * q.speed)); /* includes what they gain meanwhile, 5 % at most */
        return q;
    }
    const double out = turn * (q.speed + turn * q.pull); /* as in dem__test_wall */
    q.speed += wall->spin_bound * (dem__arm(wall, x) + out);
    return q;
}

/* Returns whether walls may be skipped for particle i. */
DEM_INLINE int dem__may_skip_wall(const dem_world *w, ptrdiff_t i) {
    return (w->def.skip & DEM_SKIP_SPACE) && dem__is_in_flight(w, i);
}

/* Skips a wall for a particle in flight at x, which has a gap to it. reach: of the parts that rotate with the particle;
   0 for the sphere around it [m]. */
static inline void dem__skip_wall(const dem_world *w, dem__convex_pair *p, int64_t step, dem_vec x, double gap,
                                  double reach) {
    const dem_wall *wall = &w->wall[-1 - p->j];
    const double slack = w->engine->pairs.position_tolerance, tau = dem__flown_until(w, p->i, step);
    if (!(gap > slack)) return;
    const double crossing = w->engine->run.has_periodic ? dem__far_from_faces(w, wall, x) : HUGE_VAL;
    const dem_vec v = dem__drift_at(w, p->i, tau), a = dem__centre_pull(w, p->i),
                  centre = dem__is_part(w, p->i) ? dem__in_box(w, dem__centre_at(w, p->i, tau)) : x;
    const dem__approach q = dem__approach_to(w, wall, centre, v, a);
    const double arm = dem__reach_in_body(w, p->i, reach);
    const double surface_speed = arm > 0.0 ? dem__turning_speed_at(w, p->i, arm) + arm * wall->spin_bound : 0.0;
    const double touch = dem__time_to_cover(gap - slack, q.speed + surface_speed, q.pull),
                 cross =
                     dem__time_to_cover(crossing - slack, dem__length(v) + dem__part_speed_of(w, p->i), dem__length(a));
    const int steps = dem__steps_until(w, cross < touch ? cross : touch);
    p->speed = wall->speed_bound, p->spin = wall->spin_bound;
    dem__skip_until(w, p, step, steps < q.most ? steps : q.most);
    p->is_close = 0;
}

/* Finds whether the sphere around a particle touches a wall, which has been moved to the step. If it does not, and the
   particle is in flight, skips the wall. */
static inline void dem__look_at_wall(const dem_world *w, dem__convex_pair *p, int64_t step) {
    const int may_rest = dem__may_skip_wall(w, p->i);
    const dem_vec x = dem__in_box(w, dem__centre_in(w, p->i, step));
    dem__touch touch[DEM__TOUCHES];
    double least;
    p->is_close = 0;
    if (!dem__is_at_wall(w, p->i, -1 - p->j)) return;
    const double slack = w->engine->pairs.position_tolerance;
    const dem_wall *wall = &w->wall[-1 - p->j];
    const double radius = w->particle[p->i].radius, limit = may_rest ? w->engine->pairs.wall_reach : slack;
    if (dem__has(wall, DEM__HALF_SPACE)) {
        dem__touch_flat(wall, dem__sub(x, wall->position), radius, touch);
        least = touch->gap;
    } else if (dem__has(wall, DEM__TRIANGULATED)) /* the nearest place is enough */
        dem__touch_mesh(wall, dem__sub(x, wall->position), radius, -HUGE_VAL, limit, touch, &least);
    else dem__touch_wall(wall, x, radius, limit, touch, &least);
    p->is_close = least < slack;
    if (!p->is_close && may_rest) dem__skip_wall(w, p, step, x, least, 0.0);
}
