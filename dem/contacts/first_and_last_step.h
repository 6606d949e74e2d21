/* Partial steps: the first and the last step of a contact. Reads a contact's rows and its law; writes its correction,
   history and losses. Promises: with the impulse and the shift, the motion of the two bodies is as accurate as in the
   steps between. */
#pragma once
#include "block.h"

/* Returns the part of the law's normal force that stems from the overlap [N], at a gap [m] and a closing speed [m/s].
   Leaves the history unchanged. */
DEM_INLINE double dem__force_alone(const dem_contact *contact, const double *state, double gap, double closing,
                                   double *elastic, const dem_law *law) {
    dem_contact c = *contact;
    dem_response r;
    double s[DEM_STATE_MAX];
    memset(&r, 0, sizeof r);
    for (int k = 0; k < law->states; k++) s[k] = state[k];
    c.gap = gap < 0.0 ? gap : -DBL_MIN;
    c.closing = closing;
    c.dt = 0.0;
    law->force(&c, s, &r);
    *elastic = r.elastic;
    return r.contact;
}

/* Moves the two bodies along the normal for a time t [s] under their contact force alone, in one fourth-order
   Runge-Kutta step. Returns the force at the end [N]. */
DEM_INLINE double dem__flow(const dem_contact *c, const double *state, double *gap, double *closing, double t,
                            const dem_law *law) {
    double g = *gap, u = *closing, m = 1.0 / c->mass, elastic;
    double a1 = -m * dem__force_alone(c, state, g, u, &elastic, law);
    double u2 = u + 0.5 * t * a1, a2 = -m * dem__force_alone(c, state, g - 0.5 * t * u, u2, &elastic, law);
    double u3 = u + 0.5 * t * a2, a3 = -m * dem__force_alone(c, state, g - 0.5 * t * u2, u3, &elastic, law);
    double u4 = u + t * a3, a4 = -m * dem__force_alone(c, state, g - t * u3, u4, &elastic, law);
    *gap = g - t / 6.0 * (u + 2.0 * u2 + 2.0 * u3 + u4);
    *closing = u + t / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    return dem__force_alone(c, state, *gap, *closing, &elastic, law);
}

/* A contact begins and ends within a step. Verlet's scheme would apply the force for the whole step or not at all.
   Therefore the normal motion of the two bodies in that step is integrated separately, and the difference from Verlet's
   motion is applied as an impulse and a shift along the normal. Verlet's velocity is a central difference, (x(t+h) -
   x(t-h)) / 2h, which differs from the true velocity by h^2/6 x'''. */
typedef struct dem__partial_motion {
    double impulse, shift; /* [N s], [kg m]: divided by a mass, changes of velocity and of position along n */
    double gap, closing;   /* at the end of the step */
    double duration;       /* how long the contact lasts within the step [s] */
    double loss, elastic;  /* dissipated by the normal dashpot in the step; stored at its end [J] */
    double before;         /* last step only: closing speed at the start of the step [m/s] */
} dem__partial_motion;

/* Integrates the normal motion through the first step of a contact. Returns 0 if the bodies do not approach. */
DEM_INLINE int dem__follow_first_step(const dem_contact *c, const double *state, dem__partial_motion *e,
                                      const dem_law *law) {
    double h = 1.0 / c->rate, t = -c->gap / c->closing, elastic;
    if (!(c->closing > 0.0)) return 0;
    e->duration = t < h ? t : h;
    e->gap = 0.0;
    e->closing = c->closing;
    dem__flow(c, state, &e->gap, &e->closing, e->duration, law);
    const double force = dem__force_alone(c, state, e->gap, e->closing, &elastic, law);
    double next = e->gap, then = e->closing;
    dem__flow(c, state, &next, &then, h, law);
    /* Verlet's scheme leads from it to `next` */
    const double handed = (e->gap - next) * c->rate + 0.5 * h * force / c->mass;
    e->impulse = c->mass * (c->closing - handed);
    e->shift = c->mass * (e->gap - c->gap);
    e->elastic = elastic;
    e->loss = 0.5 * c->mass * (c->closing * c->closing - handed * handed) - elastic;
    return 1;
}

/* Integrates the normal motion through the last step of a contact. gap, force: of the step before. Returns 0 if
   Verlet's step stands. `verlet` is the closing speed from which Verlet's scheme, for the two bodies alone, leads to
   the present gap. */
DEM_INLINE int dem__follow_last_step(const dem_contact *c, const double *state, double gap, double force,
                                     dem__partial_motion *e, const dem_law *law) {
    const double h = 1.0 / c->rate, half_kick = 0.5 * h * force / c->mass,
                 verlet = (gap - c->gap) * c->rate + half_kick;
    const double speed =
        c->closing + 2.0 * half_kick; /* nearly `verlet`, but computed from velocities, so that it holds if a wall has
                                         jumped, too */
    double own = speed;               /* true closing speed: one step back it gives the last mean speed */
    if (!(verlet < 0.0 && gap < 0.0)) return 0;
    for (int k = 0; k < 2; k++) {
        double back = gap, then = own;
        dem__flow(c, state, &back, &then, -h, law);
        own += speed + half_kick - (back - gap) * c->rate;
    }
    const double u = e->before = verlet + own - speed;
    double t = 0.0, g = gap, v = u, f = force, before, after;
    const int pulls = dem__force_alone(c, state, 0.0, u, &before, law) < 0.0;
    dem__force_alone(c, state, gap, u, &before, law);
    for (int k = 0; k < 3; k++) {
        double rest, last = h - t;
        if (pulls) rest = v < 0.0 ? g / v : 0.0; /* the dashpot may pull: the contact ends where the overlap is zero */
        else { /* the force is clipped at zero: the contact ends where it reaches zero, found from its slope over a
                  short time */
            const double moment = h / 64.0,
                         fp = dem__force_alone(c, state, g - moment * v, v - moment * f / c->mass, &after, law);
            rest = fp < f ? moment * f / (f - fp) : last;
            if (k < 2) rest *= 0.9;
        }
        rest = rest < last ? rest : last;
        f = dem__flow(c, state, &g, &v, rest, law);
        t += rest;
    }
    e->duration = t;
    e->closing = v;
    e->gap = g - (h - t) * v;
    dem__force_alone(c, state, e->gap, v, &after, law);
    e->impulse = c->mass * (verlet - v);
    e->shift = c->mass * (e->gap - c->gap);
    e->elastic = e->gap < 0.0 ? after : 0.0;
    e->loss = before - e->elastic + 0.5 * c->mass * (verlet * verlet - v * v);
    return 1;
}

/* A contact that begins or ends within a step: its state at the start, where its force at the end is written, and the
   wall's velocity. */
typedef struct dem__partial_step {
    double gap, force, state[DEM_STATE_MAX], *out[9], arm_i, arm_j;
    dem_vec wall_speed;
} dem__partial_step;

/* Adds friction and rolling, as they are in r, to an impulse: over `time` [s], and in proportion to the normal impulse
   over `scaled` [s], which is that impulse divided by the normal force of r. That force may be tiny, so friction that
   remains without it (r->remaining) is left out of the scaled part. */
DEM_INLINE void dem__add_friction_impulse(dem_response *impulse, const dem_response *r, double time, double scaled,
                                          int features) {
    for (int a = 0; a < 3; a++) {
        impulse->tangential[a] += (time + scaled) * r->tangential[a] - scaled * r->remaining[a];
        impulse->rolling[a] += features & DEM_ROLLING ? (time + scaled) * r->rolling[a] : 0.0;
    }
}

/* Adds friction in the step in which a contact begins, by a Radau rule: after a third of the time t in contact, and at
   its end, r. The normal impulse exceeds that over t because Verlet's velocities are central differences. Friction
   exceeds its own in proportion. */
DEM_INLINE void dem__begin_friction(const dem_contact *touch, const dem__partial_motion *e, double *s,
                                    const dem_response *r, dem_response *impulse, const dem_law *law, int features) {
    const double t = e->duration, beyond = e->impulse - touch->mass * (touch->closing - e->closing);
    dem_response third;
    memset(&third, 0, sizeof third);
    dem_contact q = *touch;
    q.gap = (7.0 * e->gap - t * (4.0 * touch->closing - 2.0 * e->closing)) /
            27.0; /* from the cubic through both ends of the motion */
    q.closing = t > 0.0 ? -4.0 / 3.0 * e->gap / t - e->closing / 3.0 : touch->closing;
    q.dt = t / 3.0;
    law->force(&q, s, &third);
    dem__add_friction_impulse(impulse, &third, 0.75 * t, 0.0, features);
    dem__add_friction_impulse(impulse, r, 0.25 * t, r->contact > 0.0 ? beyond / r->contact : 0.0, features);
}

/* Result of a partial step: impulses, the normal force that the next step starts from [N], the work of the wall by
   friction [J]. */
typedef struct dem__partial_result {
    dem__partial_motion e;
    dem_response impulse; /* at the end, without Verlet's own half kicks */
    double start, driven;
} dem__partial_result;

/* Corrects the step in which a contact begins, from history s: force, history and losses. Returns 0 if the contact does
   not begin. */
DEM_INLINE int dem__correct_first_step(dem_contact *q, double *s, const dem__columns *at, const dem__partial_step *was,
                                       const dem_law *law, int features, dem__partial_result *m) {
    const double half = 0.5 / q->rate;
    dem_response r;
    memset(&r, 0, sizeof r);
    if (!dem__follow_first_step(q, s, &m->e, law)) return 0;
    const dem_contact touch = *q;
    q->gap = m->e.gap;
    q->closing = m->e.closing;
    q->dt = m->e.duration;
    law->force(q, s, &r);
    for (int a = 0; a < law->history; a++) at->state[a][0] = dem__flushed(s[a]);
    dem__put_force(was->out, 0, q, &r, was->arm_i, was->arm_j, features);
    at->force[0] = m->start = r.contact;
    if (features & DEM_FRICTION) {
        for (int a = 0; a < law->history; a++) s[a] = 0.0;
        dem__begin_friction(&touch, &m->e, s, &r, &m->impulse, law, features);
        const dem_vec friction = dem__first(m->impulse.tangential);
        m->driven = dem__dot(friction, was->wall_speed);
        r.slide_loss = -dem__dot(friction, dem__first(q->slip)) - (r.elastic - m->e.elastic);
        dem__add_friction_impulse(&m->impulse, &r, -half, 0.0, features);
    }
    if (features & DEM_ENERGY) {
        const double film =
            r.normal > r.contact ? r.normal - r.contact : 0.0; /* acts for half a step, as Verlet's forces do */
        dem__put_losses(at, at, 0, &r, 0.0, 1.0);
        at->loss[2][0] = half * film * q->closing;
    }
    return 1;
}

/* Corrects the step in which a contact ends: force, history and losses. Returns 0 if Verlet's step stands. */
DEM_INLINE int dem__correct_last_step(dem_contact *q, double *s, const dem__columns *at, const dem__partial_step *was,
                                      const dem_law *law, int features, dem__partial_result *m) {
    const double half = 0.5 / q->rate;
    dem_response r;
    memset(&r, 0, sizeof r);
    if (!dem__follow_last_step(q, s, was->gap, was->force, &m->e, law)) return 0;
    if (m->e.gap < 0.0) {
        q->gap = m->e.gap;
        q->closing = m->e.closing;
        law->force(q, s, &r);
        if (r.contact < 0.0) { /* the dashpot still pulls: the contact lasts beyond this step */
            dem__put_force(was->out, 0, q, &r, was->arm_i, was->arm_j, features);
            at->force[0] = m->start = r.contact;
            if (features & DEM_ENERGY) dem__put_losses(at, at, 0, &r, 0.0, 1.0);
        }
    }
    if ((features & DEM_FRICTION) && m->start == 0.0) { /* friction decays in proportion to the normal force */
        for (int a = 0; a < law->states; a++) s[a] = was->state[a];
        q->gap = was->gap;
        q->closing = m->e.before;
        law->force(q, s, &r);
        dem__add_friction_impulse(&m->impulse, &r, 0.0, r.contact > 0.0 ? m->e.impulse / r.contact - half : 0.0,
                                  features);
        m->driven =
            dem__dot(dem__plus(dem__first(m->impulse.tangential), half, dem__first(r.tangential)), was->wall_speed);
        if (features & DEM_ENERGY) at->loss[1][0] -= dem__dot(dem__first(m->impulse.tangential), dem__first(q->slip));
    }
    return 1;
}

/* Corrects a partial step of the contact in slot c. Stores impulse and shift for the end of the step. */
DEM_INLINE void dem__correct_partial_step(dem_world *w, ptrdiff_t c, dem_contact *q, const dem__partial_step *was,
                                          const dem_law *law, int features) {
    dem__contacts *contacts = &w->engine->contacts;
    const int first = was->force == 0.0;
    dem__columns at;
    dem__partial_result m;
    double s[DEM_STATE_MAX], *impulse[9];
    dem__correction *handed = &contacts->correction[c];
    memset(&m, 0, sizeof m);
    dem__columns_of(w, c, law, features, &at);
    for (int a = 0; a < law->states; a++) s[a] = first && a < law->history ? 0.0 : at.state[a][0];
    const int mended = first ? dem__correct_first_step(q, s, &at, was, law, features, &m)
                             : dem__correct_last_step(q, s, &at, was, law, features, &m);
    contacts->partial[c] = mended != 0;
    if (!mended) return;
    if (!first && m.start != 0.0) contacts->ended[c] = 0;
    at.gap[0] = m.e.gap;
    m.impulse.normal = m.e.impulse - 0.5 / q->rate * (was->force + m.start);
    for (int a = 0; a < 3; a++) handed->n[a] = q->normal[a];
    handed->shift = m.e.shift;
    for (int a = 0; a < 9; a++) impulse[a] = &handed->impulse[a];
    dem__put_force(impulse, 0, q, &m.impulse, was->arm_i, was->arm_j, features);
    if (!(features & DEM_ENERGY)) return;
    at.loss[0][0] = m.e.loss;
    if (!first) at.elastic[0] = m.e.elastic;
    at.loss[3][0] = m.e.impulse * dem__dot(dem__first(q->normal), was->wall_speed) + m.driven;
    at.power[2][0] =
        m.start != 0.0 ? dem__dot(dem_vec3(was->out[0][0], was->out[1][0], was->out[2][0]), was->wall_speed) : 0.0;
}
