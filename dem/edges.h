/* ------------------------------------------------------------------------------------------------ >>kernel */

/* What the overlap makes of the law's normal force, within contact, at given gap and closing speed, its history untouched. */
DEM_INLINE double dem__force_alone(const dem_contact *contact, const double *state, double gap, double closing, double *elastic,
                                   const dem_law *law) {
    dem_contact c = *contact;
    dem_response r;
    double s[DEM_STATE_MAX];
    for (int k = 0; k < law->states; k++) s[k] = state[k];
    c.gap = gap < 0.0 ? gap : -DBL_MIN;
    c.closing = closing;
    c.dt = 0.0;
    law->force(&c, s, &r);
    *elastic = r.elastic;
    return r.contact;
}

/* Normal motion of the two bodies by themselves over time t, one Runge-Kutta step of fourth order. */
DEM_INLINE double dem__flow(const dem_contact *c, const double *state, double *gap, double *closing, double t, const dem_law *law) {
    double g = *gap, u = *closing, m = 1.0 / c->mass, elastic;
    double a1 = -m * dem__force_alone(c, state, g, u, &elastic, law);
    double u2 = u + 0.5 * t * a1, a2 = -m * dem__force_alone(c, state, g - 0.5 * t * u, u2, &elastic, law);
    double u3 = u + 0.5 * t * a2, a3 = -m * dem__force_alone(c, state, g - 0.5 * t * u2, u3, &elastic, law);
    double u4 = u + t * a3, a4 = -m * dem__force_alone(c, state, g - t * u3, u4, &elastic, law);
    *gap = g - t / 6.0 * (u + 2.0 * u2 + 2.0 * u3 + u4);
    *closing = u + t / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    return dem__force_alone(c, state, *gap, *closing, &elastic, law);
}

/* The first and the last step of a contact are cut: Verlet would give them a whole step's force or none. Here the two bodies' normal
   motion through such a step is followed by itself, and the difference is handed on as an impulse and a shift along the normal. A
   velocity of Verlet's is the chord over two steps of the motion that it follows: from the motion's own, a sixth of h^2 times its
   second derivative. */
typedef struct dem__edge_motion {
    double impulse, shift; /* [N s], [kg m]: divided by a mass, change of velocity and of position along n */
    double gap, closing;   /* at the end of the step */
    double duration;       /* of contact within the step [s] */
    double loss, elastic;  /* dissipated by the normal dashpot in the step, stored at its end [J] */
    double before;         /* of a contact that ends: its closing speed at the start of the step [m/s] */
} dem__edge_motion;

/* Returns 0 if there is nothing to mend. The impulse is the whole of the step's. */
DEM_INLINE int dem__follow_first_step(const dem_contact *c, const double *state, dem__edge_motion *e, const dem_law *law) {
    double h = 1.0 / c->rate, t = -c->gap / c->closing, elastic;
    if (!(c->closing > 0.0)) return 0;
    e->duration = t < h ? t : h;
    e->gap = 0.0;
    e->closing = c->closing;
    dem__flow(c, state, &e->gap, &e->closing, e->duration, law);
    const double force = dem__force_alone(c, state, e->gap, e->closing, &elastic, law);
    double next = e->gap, then = e->closing;
    dem__flow(c, state, &next, &then, h, law);
    const double handed = (e->gap - next) * c->rate + 0.5 * h * force / c->mass; /* leads there within the next step */
    e->impulse = c->mass * (c->closing - handed);
    e->shift = c->mass * (e->gap - c->gap);
    e->elastic = elastic;
    e->loss = 0.5 * c->mass * (c->closing * c->closing - handed * handed) - elastic;
    return 1;
}

/* gap and force: of the step before. The closing speed is that from which Verlet, for the two bodies alone, leads to the gap of now. */
DEM_INLINE int dem__follow_last_step(const dem_contact *c, const double *state, double gap, double force, dem__edge_motion *e,
                                     const dem_law *law) {
    const double h = 1.0 / c->rate, half_kick = 0.5 * h * force / c->mass, verlet = (gap - c->gap) * c->rate + half_kick;
    const double speed = c->closing + 2.0 * half_kick; /* nearly the same, from velocities: sane where a wall has leapt */
    double own = speed;                                /* the motion's own: it comes along the chord of the step before */
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
        if (pulls) rest = v < 0.0 ? g / v : 0.0; /* a pulling dashpot lets go when the overlap is zero */
        else {                                   /* a clipped one when the force is: follow its slope, found a moment later */
            const double moment = h / 64.0, fp = dem__force_alone(c, state, g - moment * v, v - moment * f / c->mass, &after, law);
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
