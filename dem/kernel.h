/* What is known of a block of contacts before the law is asked. */
typedef struct dem__rows {
    dem__row dx, dy, dz;             /* centre of i from that of j (wall: from the nearest point) */
    dem__row vx, vy, vz, ax, ay, az; /* relative velocity in the middle of the step, relative acceleration */
    dem__row wi[3], wj[3];           /* spins */
    dem__row nx, ny, nz, gap, inverse;
} dem__rows;

/* What is known of a contact since its birth. Kept from block to block, as most contacts are of the same kinds. */
typedef struct dem__type_rows {
    int32_t kind[DEM__BLOCK]; /* of which the rows are; -2: of none yet */
    dem__row mass, predict, sum, part, constant[DEM_CONSTANTS_MAX];
} dem__type_rows;

/* The geometry of contact k, as the law sees it. */
DEM_INLINE void dem__contact_geometry(const dem__rows *b, const dem__type_rows *t, int k, double half, int has_friction, dem_contact *q,
                                      double *arm_i, double *arm_j) {
    const double nx = b->nx[k], ny = b->ny[k], nz = b->nz[k];
    const double along = b->vx[k] * nx + b->vy[k] * ny + b->vz[k] * nz;
    q->normal[0] = nx, q->normal[1] = ny, q->normal[2] = nz;
    q->gap = b->gap[k];
    q->closing = -along - half * (b->ax[k] * nx + b->ay[k] * ny + b->az[k] * nz);
    if (!has_friction) return;
    /* arms D r_i/(r_i + r_j) add up to the distance, so that no angular momentum is made */
    const double distance = t->sum[k] + b->gap[k], ai = t->part[k] * distance, aj = (1.0 - t->part[k]) * distance;
    const double sx = ai * b->wi[0][k] + aj * b->wj[0][k], sy = ai * b->wi[1][k] + aj * b->wj[1][k],
                 sz = ai * b->wi[2][k] + aj * b->wj[2][k];
    *arm_i = ai, *arm_j = aj;
    q->translation[0] = b->vx[k] - along * nx, q->translation[1] = b->vy[k] - along * ny, q->translation[2] = b->vz[k] - along * nz;
    q->slip[0] = q->translation[0] + (ny * sz - nz * sy);
    q->slip[1] = q->translation[1] + (nz * sx - nx * sz);
    q->slip[2] = q->translation[2] + (nx * sy - ny * sx);
    q->spin[0] = b->wi[0][k] - b->wj[0][k], q->spin[1] = b->wi[1][k] - b->wj[1][k], q->spin[2] = b->wi[2][k] - b->wj[2][k];
}

/* Turns a tangential vector of the history with the contact: from the old normal to the new one, which the tangential velocity
   connects, to second order without a root; and about the normal with the mean spin. */
DEM_INLINE void dem__turn(const dem__rows *b, int k, double h, double *s) {
    const double nx = b->nx[k], ny = b->ny[k], nz = b->nz[k], by = 0.5 * h * b->inverse[k];
    const double along = b->vx[k] * nx + b->vy[k] * ny + b->vz[k] * nz;
    const double twist = 0.5 * h * ((b->wi[0][k] + b->wj[0][k]) * nx + (b->wi[1][k] + b->wj[1][k]) * ny + (b->wi[2][k] + b->wj[2][k]) * nz);
    const double x = s[0], y = s[1], z = s[2], out = x * nx + y * ny + z * nz;
    s[0] = x - out * (nx - by * (b->vx[k] - along * nx)) + twist * (ny * z - nz * y);
    s[1] = y - out * (ny - by * (b->vy[k] - along * ny)) + twist * (nz * x - nx * z);
    s[2] = z - out * (nz - by * (b->vz[k] - along * nz)) + twist * (nx * y - ny * x);
}

/* Where the slots of contacts begin: in the world, or in a block. */
typedef struct dem__columns {
    double *state[DEM_STATE_MAX], *out[9], *gap, *force, *elastic, *power[3], *loss[4];
} dem__columns;

/* What is new of a block of contacts. */
typedef struct dem__block_rows {
    dem__row state[DEM_STATE_MAX], out[9], gap, force, elastic, power[3], loss[4];
} dem__block_rows;

DEM_INLINE void dem__columns_of(const dem_world *w, ptrdiff_t c, const dem_law *law, int features, dem__columns *at) {
    const dem__contacts *contacts = &w->engine->contacts;
    for (int a = 0; a < law->states; a++) at->state[a] = contacts->state[a] + c;
    for (int a = 0; a < 9; a++) at->out[a] = contacts->wrench[a] + c;
    at->gap = contacts->gap + c, at->force = contacts->force + c;
    for (int a = 0; a < 3 && features & DEM_ENERGY; a++) at->power[a] = contacts->power[a] + c;
    for (int a = 0; a < 4 && features & DEM_ENERGY; a++) at->loss[a] = contacts->loss[a] + c;
    at->elastic = features & DEM_ENERGY ? contacts->elastic + c : NULL;
}

/* Where what is new of a block goes: forces into the block, as they are kept only if somebody asks. */
DEM_INLINE void dem__new_columns(const dem_world *w, ptrdiff_t c, const dem_law *law, int features, dem__block_rows *b, dem__columns *at) {
    dem__columns_of(w, c, law, features, at);
    for (int a = 0; a < 9; a++) at->out[a] = b->out[a];
    if (!DEM__COPY_ROWS) return;
    for (int a = 0; a < DEM_STATE_MAX; a++) at->state[a] = b->state[a];
    for (int a = 0; a < 3; a++) at->power[a] = b->power[a];
    for (int a = 0; a < 4; a++) at->loss[a] = b->loss[a];
    at->gap = b->gap, at->force = b->force, at->elastic = b->elastic;
}

/* From there to the world. */
DEM_INLINE void dem__store(const dem__columns *to, const dem__columns *from, int n, const dem_law *law, int features, int keeps_out) {
    const size_t bytes = (size_t)n * sizeof(double);
    for (int a = 0; a < (features & DEM_FRICTION ? 9 : 3) && keeps_out; a++) memcpy(to->out[a], from->out[a], bytes);
    if (!DEM__COPY_ROWS) return;
    for (int a = 0; a < law->history; a++) memcpy(to->state[a], from->state[a], bytes);
    memcpy(to->gap, from->gap, bytes), memcpy(to->force, from->force, bytes);
    if (!(features & DEM_ENERGY)) return;
    for (int a = 0; a < 3; a++) memcpy(to->power[a], from->power[a], bytes);
    for (int a = 0; a < 4; a++) memcpy(to->loss[a], from->loss[a], bytes);
    memcpy(to->elastic, from->elastic, bytes);
}

/* Of a block in which each contact has its own. */
static inline void dem__copy_types(const dem_world *w, ptrdiff_t base, int n, int constants, dem__type_rows *t) {
    const dem__contacts *contacts = &w->engine->contacts;
    const size_t bytes = (size_t)n * sizeof(double);
    memcpy(t->mass, contacts->mass + base, bytes), memcpy(t->predict, contacts->predict + base, bytes);
    memcpy(t->sum, contacts->sum + base, bytes), memcpy(t->part, contacts->part + base, bytes);
    for (int a = 0; a < constants; a++) memcpy(t->constant[a], contacts->constant[a] + base, bytes);
    for (int k = 0; k < n; k++) t->kind[k] = -1;
}

/* Of those slots of a block whose kind is not that of before. */
static DEM__NOINLINE void dem__renew_types(const dem_world *w, ptrdiff_t base, int n, int constants, dem__type_rows *t) {
    const dem__contacts *contacts = &w->engine->contacts;
    const int32_t *kind = contacts->type + base;
    int32_t own = -1;
    for (int k = 0; k < n; k++) own &= kind[k];
    if (own < 0) {
        dem__copy_types(w, base, n, constants, t);
        return;
    }
    for (int k = 0; k < n; k++) {
        const ptrdiff_t c = base + k;
        if (kind[k] >= 0 && kind[k] == t->kind[k]) continue;
        t->kind[k] = kind[k];
        if (kind[k] >= 0) {
            const dem__contact_type *of = &contacts->types[kind[k]];
            t->mass[k] = of->mass, t->predict[k] = of->predict, t->sum[k] = of->sum, t->part[k] = of->part;
            for (int a = 0; a < constants; a++) t->constant[a][k] = of->constant[a];
        } else {
            t->mass[k] = contacts->mass[c], t->predict[k] = contacts->predict[c], t->sum[k] = contacts->sum[c],
            t->part[k] = contacts->part[c];
            for (int a = 0; a < constants; a++) t->constant[a][k] = contacts->constant[a][c];
        }
    }
}
DEM_INLINE void dem__load_types(const dem_world *w, ptrdiff_t base, int n, int constants, dem__type_rows *t) {
    const int32_t *kind = w->engine->contacts.type + base;
    int32_t differ = 0;
    for (int k = 0; k < n; k++) differ |= (kind[k] ^ t->kind[k]) | kind[k] >> 31;
    if (differ) dem__renew_types(w, base, n, constants, t);
}

/* Force on i, torques on i and j. */
DEM_INLINE void dem__put_force(double *const *out, ptrdiff_t c, const dem_contact *q, const dem_response *r, double arm_i, double arm_j,
                               int features) {
    const double nx = q->normal[0], ny = q->normal[1], nz = q->normal[2];
    if (!(features & DEM_FRICTION)) {
        out[0][c] = r->normal * nx, out[1][c] = r->normal * ny, out[2][c] = r->normal * nz;
        return;
    }
    const double tx = r->tangential[0], ty = r->tangential[1], tz = r->tangential[2];
    const double mx = ny * tz - nz * ty, my = nz * tx - nx * tz, mz = nx * ty - ny * tx;
    const double rx = features & DEM_ROLLING ? r->rolling[0] : 0.0, ry = features & DEM_ROLLING ? r->rolling[1] : 0.0;
    const double rz = features & DEM_ROLLING ? r->rolling[2] : 0.0;
    out[0][c] = r->normal * nx + tx, out[1][c] = r->normal * ny + ty, out[2][c] = r->normal * nz + tz;
    out[3][c] = rx - arm_i * mx, out[4][c] = ry - arm_i * my, out[5][c] = rz - arm_i * mz;
    out[6][c] = -rx - arm_j * mx, out[7][c] = -ry - arm_j * my, out[8][c] = -rz - arm_j * mz;
}

/* Losses of a step: powers by the trapezoidal rule. In a clipped contact that only unloads, the spring gives its energy to nobody. */
DEM_INLINE void dem__put_losses(const dem__columns *at, const dem__columns *old, ptrdiff_t c, const dem_response *r, double h,
                                double contact_before) {
    const double unloaded = old->elastic[c] - r->elastic, damped = 0.5 * h * (old->power[0][c] + r->normal_power);
    at->loss[0][c] = fabs(contact_before) + fabs(r->contact) == 0.0 ? unloaded : damped;
    at->loss[1][c] = r->slide_loss;
    at->loss[2][c] = 0.5 * h * (old->power[1][c] + r->rolling_power);
    at->power[0][c] = r->normal_power;
    at->power[1][c] = r->rolling_power;
    at->elastic[c] = r->elastic;
}

/* Where a wall is touched by the contact in a slot or, without one (-1), by a link. */
DEM_INLINE void dem__touch_place(const dem_world *w, ptrdiff_t slot, const dem_wall *wall, dem_vec x, double radius, int32_t element,
                                 dem__touch *touch) {
    const dem__contacts *contacts = &w->engine->contacts;
    if (slot >= 0 && wall->kind == DEM_MESH) {
        touch->normal = dem_vec3(contacts->touch[0][slot], contacts->touch[1][slot], contacts->touch[2][slot]);
        touch->gap = contacts->touch[3][slot];
    } else dem__touch_element(wall, x, radius, element, touch);
}

/* Where row k of a block is at a wall. */
typedef struct dem__wall_row {
    const dem_particle *particle;
    const dem_wall *wall;
    int row;
    dem_vec from, velocity; /* the centre from its axis [m], and the wall's there [m/s] */
    double outside, inner;  /* 1, -1 inside, of a round wall, whose surface is so far from its axis; 0: elsewhere, the touch is known */
    dem__touch touch;
} dem__wall_row;

/* Particle i at an element of a wall, for the contact in a slot or a link (-1), into row k. A round wall is like another sphere: root and
   quotient are left to dem__complete_rows. */
static DEM__NOINLINE void dem__gather_wall(const dem_world *w, ptrdiff_t i, ptrdiff_t number, int32_t element, ptrdiff_t slot, dem__rows *b,
                                           int k, double half, dem__wall_row *at) {
    const dem_wall *wall = &w->wall[number];
    const dem_particle *s = &w->particle[i];
    at->particle = s, at->wall = wall, at->row = k, at->velocity = wall->velocity;
    at->outside = dem__reach_round(wall, s->x, element, &at->from, &at->inner);
    if (at->outside == 0.0) {
        dem__touch_place(w, slot, wall, s->x, s->radius, element, &at->touch);
        at->from = dem_vec3(s->radius + at->touch.gap, 0.0, 0.0);
    }
    b->dx[k] = at->from.x, b->dy[k] = at->from.y, b->dz[k] = at->from.z;
    b->vx[k] = s->v.x - (wall->velocity.x - half * wall->acceleration.x);
    b->vy[k] = s->v.y - (wall->velocity.y - half * wall->acceleration.y);
    b->vz[k] = s->v.z - (wall->velocity.z - half * wall->acceleration.z);
    b->ax[k] = s->a.x - wall->acceleration.x, b->ay[k] = s->a.y - wall->acceleration.y, b->az[k] = s->a.z - wall->acceleration.z;
    b->wi[0][k] = s->spin.x, b->wi[1][k] = s->spin.y, b->wi[2][k] = s->spin.z;
    b->wj[0][k] = b->wj[1][k] = b->wj[2][k] = 0.0;
}

/* The same where the wall's surface slides: at the point that is touched. */
static DEM__NOINLINE void dem__slide(dem__rows *b, double half, dem__wall_row *at) {
    const int k = at->row;
    const dem_wall *wall = at->wall;
    const dem_particle *s = at->particle;
    const dem_vec n = dem_vec3(b->nx[k], b->ny[k], b->nz[k]), point = dem__plus(s->x, -(s->radius + b->gap[k]), n);
    const dem_vec a = dem__surface_acceleration(wall, point), spin = dem__scale(wall->spin, wall->spin_axis);
    at->velocity = dem__surface_velocity(wall, point, n);
    const dem_vec v = dem__sub(s->v, dem__plus(at->velocity, -half, a));
    b->vx[k] = v.x, b->vy[k] = v.y, b->vz[k] = v.z;
    b->ax[k] = s->a.x - a.x, b->ay[k] = s->a.y - a.y, b->az[k] = s->a.z - a.z;
    b->wj[0][k] = spin.x, b->wj[1][k] = spin.y, b->wj[2][k] = spin.z;
}

DEM_INLINE void dem__gather_pair(const dem_world *w, ptrdiff_t i, ptrdiff_t j, dem__rows *b, int k, int has_friction) {
    const dem_particle *p = &w->particle[i], *q = &w->particle[j];
    b->dx[k] = p->x.x - q->x.x, b->dy[k] = p->x.y - q->x.y, b->dz[k] = p->x.z - q->x.z;
    b->vx[k] = p->v.x - q->v.x, b->vy[k] = p->v.y - q->v.y, b->vz[k] = p->v.z - q->v.z;
    b->ax[k] = p->a.x - q->a.x, b->ay[k] = p->a.y - q->a.y, b->az[k] = p->a.z - q->a.z;
    if (!has_friction) return;
    b->wi[0][k] = p->spin.x, b->wi[1][k] = p->spin.y, b->wi[2][k] = p->spin.z;
    b->wj[0][k] = q->spin.x, b->wj[1][k] = q->spin.y, b->wj[2][k] = q->spin.z;
}

/* Of the mass of i, and of j unless it is a wall, that a contact may count on. */
DEM_INLINE double dem__mass_share(const dem_world *w, ptrdiff_t i, ptrdiff_t j) {
    const double a = w->engine->bodies.mass_share[i], b = w->engine->bodies.mass_share[j < 0 ? i : j];
    return a < b ? a : b;
}

/* Nearest images; positions of active particles lie within the periodic box. */
DEM_INLINE void dem__wrap_row(double *row, int n, double length) {
    for (int k = 0; k < n; k++) row[k] = dem__image(row[k], length);
}

/* Of a wall's row. */
DEM_INLINE void dem__complete_wall(dem__rows *b, double half, dem__wall_row *at) {
    const int k = at->row;
    const double radius = at->particle->radius;
    if (at->outside == 0.0) {
        b->nx[k] = at->touch.normal.x, b->ny[k] = at->touch.normal.y, b->nz[k] = at->touch.normal.z;
        b->gap[k] = at->touch.gap;
    } else {
        b->nx[k] *= at->outside, b->ny[k] *= at->outside, b->nz[k] *= at->outside, b->inverse[k] *= at->outside;
        b->gap[k] = at->outside * (b->gap[k] + radius - at->inner) - radius;
    }
    if (at->wall->slides) dem__slide(b, half, at);
}

/* Nearest images, normals and gaps of a block with some rows at walls. */
DEM_INLINE void dem__complete_rows(const dem_world *w, dem__rows *b, const dem__type_rows *t, int n, double half, dem__wall_row *wall,
                                   int walls) {
    if (w->def.periodic[0]) dem__wrap_row(b->dx, n, w->def.high.x - w->def.low.x);
    if (w->def.periodic[1]) dem__wrap_row(b->dy, n, w->def.high.y - w->def.low.y);
    if (w->def.periodic[2]) dem__wrap_row(b->dz, n, w->def.high.z - w->def.low.z);
    for (int q = 0; q < walls && w->engine->run.has_periodic; q++) { /* walls have no images */
        const int k = wall[q].row;
        b->dx[k] = wall[q].from.x, b->dy[k] = wall[q].from.y, b->dz[k] = wall[q].from.z;
    }
    for (int k = 0; k < n; k++) {
        const double distance = sqrt(b->dx[k] * b->dx[k] + b->dy[k] * b->dy[k] + b->dz[k] * b->dz[k]), inverse = 1.0 / distance;
        b->nx[k] = b->dx[k] * inverse, b->ny[k] = b->dy[k] * inverse, b->nz[k] = b->dz[k] * inverse;
        b->inverse[k] = inverse;
        b->gap[k] = distance - t->sum[k];
    }
    for (int q = 0; q < walls; q++) dem__complete_wall(b, half, &wall[q]);
}

/* A contact that begins or ends within a step: what it was at the start, where its force at the end goes, and the wall's velocity. */
typedef struct dem__edge {
    double gap, force, state[DEM_STATE_MAX], *out[9], arm_i, arm_j;
    dem_vec wall_speed;
} dem__edge;

/* Adds to an impulse what friction and rolling do as they are in r: in a time, and in one that follows from a normal impulse over the force
   of the contact. That may be next to nothing, so what would remain without it has no part there. */
DEM_INLINE void dem__add_friction_impulse(dem_response *impulse, const dem_response *r, double time, double scaled, int features) {
    for (int a = 0; a < 3; a++) {
        impulse->tangential[a] += (time + scaled) * r->tangential[a] - scaled * r->remaining[a];
        impulse->rolling[a] += features & DEM_ROLLING ? (time + scaled) * r->rolling[a] : 0.0;
    }
}

/* Friction within the step in which a contact begins, from what it is after a third of the time t and at the end, r (Radau); what the
   normal impulse has beyond its own t, because Verlet's velocities are chords, friction has in proportion. */
DEM_INLINE void dem__begin_friction(const dem_contact *touch, const dem__edge_motion *e, double *s, const dem_response *r,
                                    dem_response *impulse, const dem_law *law, int features) {
    const double t = e->duration, beyond = e->impulse - touch->mass * (touch->closing - e->closing);
    dem_response third;
    memset(&third, 0, sizeof third);
    dem_contact q = *touch;
    q.gap = (7.0 * e->gap - t * (4.0 * touch->closing - 2.0 * e->closing)) / 27.0; /* of the cubic from end to end */
    q.closing = t > 0.0 ? -4.0 / 3.0 * e->gap / t - e->closing / 3.0 : touch->closing;
    q.dt = t / 3.0;
    law->force(&q, s, &third);
    dem__add_friction_impulse(impulse, &third, 0.75 * t, 0.0, features);
    dem__add_friction_impulse(impulse, r, 0.25 * t, r->contact > 0.0 ? beyond / r->contact : 0.0, features);
}

/* What a first or last step hands over: impulses, the normal force that the next step starts from, the work of the wall by friction. */
typedef struct dem__edge_result {
    dem__edge_motion e;
    dem_response impulse; /* in the end beside the half steps that Verlet hands over */
    double start, driven;
} dem__edge_result;

/* The step in which a contact begins, from history s: force, history and losses. 0: it does not begin. */
DEM_INLINE int dem__correct_first_step(dem_contact *q, double *s, const dem__columns *at, const dem__edge *was, const dem_law *law,
                                       int features, dem__edge_result *m) {
    const double half = 0.5 / q->rate;
    dem_response r;
    memset(&r, 0, sizeof r);
    if (!dem__follow_first_step(q, s, &m->e, law)) return 0;
    const dem_contact touch = *q;
    q->gap = m->e.gap;
    q->closing = m->e.closing;
    q->dt = m->e.duration;
    law->force(q, s, &r);
    for (int a = 0; a < law->history; a++) at->state[a][0] = s[a];
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
        const double film = r.normal > r.contact ? r.normal - r.contact : 0.0; /* acts half a step, as forces of Verlet's do */
        dem__put_losses(at, at, 0, &r, 0.0, 1.0);
        at->loss[2][0] = half * film * q->closing;
    }
    return 1;
}

/* The step in which it ends, likewise. 0: Verlet's step stands. */
DEM_INLINE int dem__correct_last_step(dem_contact *q, double *s, const dem__columns *at, const dem__edge *was, const dem_law *law,
                                      int features, dem__edge_result *m) {
    const double half = 0.5 / q->rate;
    dem_response r;
    memset(&r, 0, sizeof r);
    if (!dem__follow_last_step(q, s, was->gap, was->force, &m->e, law)) return 0;
    if (m->e.gap < 0.0) {
        q->gap = m->e.gap;
        q->closing = m->e.closing;
        law->force(q, s, &r);
        if (r.contact < 0.0) { /* Verlet would end it a moment too soon, while the dashpot still pulls */
            dem__put_force(was->out, 0, q, &r, was->arm_i, was->arm_j, features);
            at->force[0] = m->start = r.contact;
            if (features & DEM_ENERGY) dem__put_losses(at, at, 0, &r, 0.0, 1.0);
        }
    }
    if ((features & DEM_FRICTION) && m->start == 0.0) { /* friction fades with the normal force */
        for (int a = 0; a < law->states; a++) s[a] = was->state[a];
        q->gap = was->gap;
        q->closing = m->e.before;
        law->force(q, s, &r);
        dem__add_friction_impulse(&m->impulse, &r, 0.0, r.contact > 0.0 ? m->e.impulse / r.contact - half : 0.0, features);
        m->driven = dem__dot(dem__plus(dem__first(m->impulse.tangential), half, dem__first(r.tangential)), was->wall_speed);
        if (features & DEM_ENERGY) at->loss[1][0] -= dem__dot(dem__first(m->impulse.tangential), dem__first(q->slip));
    }
    return 1;
}

/* Mends a first or last step of the contact in slot c, and leaves impulses and shift for the end of the step. */
DEM_INLINE void dem__correct_edge(dem_world *w, ptrdiff_t c, dem_contact *q, const dem__edge *was, const dem_law *law, int features) {
    dem__contacts *contacts = &w->engine->contacts;
    const int first = was->force == 0.0;
    dem__columns at;
    dem__edge_result m;
    double s[DEM_STATE_MAX], *impulse[9];
    dem__correction *handed = &contacts->correction[c];
    memset(&m, 0, sizeof m);
    dem__columns_of(w, c, law, features, &at);
    for (int a = 0; a < law->states; a++) s[a] = first && a < law->history ? 0.0 : at.state[a][0];
    const int mended =
        first ? dem__correct_first_step(q, s, &at, was, law, features, &m) : dem__correct_last_step(q, s, &at, was, law, features, &m);
    contacts->edge[c] = mended != 0;
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
    at.power[2][0] = m.start != 0.0 ? dem__dot(dem_vec3(was->out[0][0], was->out[1][0], was->out[2][0]), was->wall_speed) : 0.0;
}

typedef void dem__edge_fn(dem_world *w, ptrdiff_t c, dem_contact *q, const dem__edge *was);

/* Did a contact begin or end in this step, by its forces and the gap before? All bits: choices would keep the loop scalar. */
DEM_INLINE int64_t dem__began_or_ended(double before, double now, double gap_before) {
    const int64_t idle = before == 0.0;
    return (idle ^ (int64_t)(now == 0.0)) & ((idle ^ 1) | (int64_t)(gap_before > 0.0));
}

/* Marks and lists such contacts of a chunk, and those whose law has ended, in the block from slot base on. How many? */
DEM_INLINE ptrdiff_t dem__mark_edges(dem_world *w, dem__chunk *in, ptrdiff_t base, int n, const double *before, const double *was,
                                     const double *ended, const double *force) {
    dem__contacts *contacts = &w->engine->contacts;
    const ptrdiff_t marked = in->marked;
    int64_t mark[DEM__BLOCK], any = 0;
    for (int k = 0; k < n; k++) {
        mark[k] = dem__began_or_ended(before[k], force[k], was[k]) | (int64_t)(ended[k] != 0.0) << 1;
        any |= mark[k];
    }
    for (int k = 0; k < n && any; k++) {
        if (!mark[k]) continue;
        contacts->edge[base + k] = (uint8_t)(mark[k] & 1);
        contacts->ended[base + k] = (uint8_t)(mark[k] >> 1);
        contacts->slots[in->first + in->marked++] = (int32_t)(base + k);
    }
    return in->marked - marked;
}

DEM_INLINE void dem__add_load(dem__sum *sum, const double *load, int has_friction) {
    for (int a = 0; a < (has_friction ? 6 : 3); a++) sum->load[a] += load[a];
}

/* Adds what a contact in chunk q does, force on i and torques on i and j in out[][k]: to the sum of i, to that of j or of a wall. */
DEM_INLINE void dem__add_forces(dem_world *w, ptrdiff_t q, int32_t i, int32_t j, double *const *out, ptrdiff_t k, int has_friction,
                                int to_i, int to_j) {
    const double fx = out[0][k], fy = out[1][k], fz = out[2][k];
    const double on_i[6] = {fx, fy, fz, has_friction ? out[3][k] : 0.0, has_friction ? out[4][k] : 0.0, has_friction ? out[5][k] : 0.0};
    const double on_j[6] = {-fx, -fy, -fz, has_friction ? out[6][k] : 0.0, has_friction ? out[7][k] : 0.0, has_friction ? out[8][k] : 0.0};
    if (to_i) dem__add_load(&w->engine->bodies.sum[i], on_i, has_friction);
    if (!to_j) return;
    if (j >= 0) {
        dem__add_load(&w->engine->bodies.sum[j], on_j, has_friction);
        return;
    }
    dem__wall_force *push = &w->engine->contacts.wall_force[q * w->engine->walls.capacity - 1 - j];
    const dem_vec f = dem_vec3(on_j[0], on_j[1], on_j[2]), t = dem_vec3(on_i[3], on_i[4], on_i[5]);
    const dem_vec arm = dem__sub(w->particle[i].x, w->wall[-1 - j].position);
    push->force = dem__add(push->force, f);
    push->torque = dem__add(push->torque, dem__sub(dem__cross(arm, f), t));
}

/* Adds what n contacts of chunk q do, slot by slot, in the order of which sums are; leaves to dem__add_postponed what must wait for other
   threads. */
DEM_INLINE void dem__gather_forces(dem_world *w, ptrdiff_t q, ptrdiff_t base, int n, double *const *out, int has_friction) {
    dem__contacts *contacts = &w->engine->contacts;
    dem__chunk *in = &contacts->chunk[q];
    const int32_t own = in->postpone_from;
    int waits = 0;
    for (int k = 0; k < n; k++) waits |= (contacts->i[base + k] >= own) | (contacts->j[base + k] >= own);
    for (int k = 0; k < n && !waits; k++) dem__add_forces(w, q, contacts->i[base + k], contacts->j[base + k], out, k, has_friction, 1, 1);
    for (int k = 0; k < n && waits; k++) {
        const int32_t i = contacts->i[base + k], j = contacts->j[base + k], last = j > i ? j : i; /* a wall's j is less than 0 */
        dem__add_forces(w, q, i, j, out, k, has_friction, i < own, j < own);
        if (last < own) continue;
        dem__postponed *later = &contacts->postponed[in->first + in->postponed++];
        for (int a = 0; a < (has_friction ? 9 : 3); a++) later->out[a] = out[a][k];
        later->i = i, later->j = j;
        const int32_t first = i < own ? j : i;
        in->low = first < in->low ? first : in->low, in->high = last > in->high ? last : in->high;
    }
}

/* Ahead of a link or a contact; of a wall (less than 0) nothing needs to be asked for. */
DEM_INLINE void dem__prefetch_particle(const dem_world *w, ptrdiff_t j) {
    const dem_particle *p = &w->particle[j < 0 ? 0 : j];
    DEM__PREFETCH(&p->x);
    DEM__PREFETCH(&p->a);
}
DEM_INLINE void dem__prefetch_body(const dem_world *w, ptrdiff_t j) {
    dem__prefetch_particle(w, j);
    DEM__PREFETCH(&w->engine->bodies.sum[j < 0 ? 0 : j]);
}

DEM_INLINE void dem__prefetch_contact(const dem_world *w, ptrdiff_t c) {
    dem__prefetch_body(w, w->engine->contacts.i[c]);
    dem__prefetch_body(w, w->engine->contacts.j[c]);
}

/* Evaluates the contacts of a chunk. Each stands alone: what it reads is of its own slot and of particles and walls that do not change
   meanwhile, what it writes is of its own slot; hence any division among threads gives the same bits. Each block is summed while it is in
   the cache. */
DEM_INLINE void dem__evaluate_chunk(dem_world *w, ptrdiff_t chunk, dem__type_rows *types, const dem_law *law, dem__edge_fn *mend,
                                    int features) {
    const dem__run *run = &w->engine->run;
    dem__contacts *contacts = &w->engine->contacts;
    const int has_friction = (features & DEM_FRICTION) != 0;
    const double h = run->kernel_dt, rate = 1.0 / run->dt, half = 0.5 * h;
    const void *user = w->user;
    dem__chunk *in = &contacts->chunk[chunk];
    const ptrdiff_t end = in->first + in->count;
    dem__rows b;
    dem__block_rows block;
    for (ptrdiff_t base = in->first; base < end; base += DEM__BLOCK) {
        const int n = end - base < DEM__BLOCK ? (int)(end - base) : DEM__BLOCK;
        dem__wall_row wall[DEM__BLOCK];
        int walls = 0;

        /* the next block, of this chunk or of the one after it, is asked for ahead */
        const dem__chunk *then = base + DEM__BLOCK < end || chunk + 1 == contacts->chunk_count ? in : in + 1;
        const ptrdiff_t ahead = then == in ? base + DEM__BLOCK : then->first, stop = then->first + then->count;
        for (int k = 0; k < n; k++) {
            const ptrdiff_t c = base + k, i = contacts->i[c], j = contacts->j[c];
            if (ahead + k < stop) dem__prefetch_contact(w, ahead + k);
            if (j >= 0) dem__gather_pair(w, i, j, &b, k, has_friction);
            else dem__gather_wall(w, i, -1 - j, contacts->element[c], c, &b, k, half, &wall[walls++]);
        }
        for (int k = n; k < DEM__BLOCK && ahead + k < stop; k++) dem__prefetch_contact(w, ahead + k);
        dem__load_types(w, base, n, law->constants, types);
        dem__complete_rows(w, &b, types, n, half, wall, walls);
        dem__row share; /* by itself, so that it is not even computed for a law that does not ask for it */
        for (int k = 0; k < n; k++) share[k] = dem__mass_share(w, contacts->i[base + k], contacts->j[base + k]);

        dem__row before, was, ended, past[DEM_STATE_MAX];
        dem__columns old, at;
        dem__columns_of(w, base, law, features, &old);
        dem__new_columns(w, base, law, features, &block, &at);
        DEM__INDEPENDENT
        for (int k = 0; k < n; k++) {
            dem_contact q;
            dem_response r;
            double s[DEM_STATE_MAX], p[DEM_CONSTANTS_MAX], arm_i = 0.0, arm_j = 0.0;
            for (int a = 0; a < law->constants; a++) p[a] = types->constant[a][k];
            for (int a = 0; a < law->states; a++) s[a] = old.state[a][k];
            for (int a = 0; a < law->vectors; a++) dem__turn(&b, k, h, s + 3 * a);
            for (int a = 0; a < law->history && has_friction; a++) past[a][k] = s[a];
            dem__contact_geometry(&b, types, k, half, has_friction, &q, &arm_i, &arm_j);
            const double predict = types->predict[k]; /* read outside the choice, or the loop does not vectorise */
            q.closing *= b.gap[k] < 0.0 ? predict : 1.0;
            q.mass = types->mass[k];
            q.share = share[k];
            q.dt = h;
            q.rate = rate;
            q.constants = p;
            q.user = user;
            law->force(&q, s, &r);
            for (int a = 0; a < law->history; a++) at.state[a][k] = s[a];
            before[k] = old.force[k], was[k] = old.gap[k], ended[k] = r.ended;
            at.force[k] = r.contact;
            at.gap[k] = b.gap[k];
            dem__put_force(at.out, k, &q, &r, arm_i, arm_j, features);
            if (features & DEM_ENERGY) {
                r.normal_power *= 1.0 - (1.0 - predict) / 11.0; /* its work along a step: k/24 less; predict is 1 - 11 k/24 */
                dem__put_losses(&at, &old, k, &r, h, before[k]);
            }
        }
        const ptrdiff_t marked = dem__mark_edges(w, in, base, n, before, was, ended, at.force);
        if (features & DEM_ENERGY) {
            for (int k = 0; k < n; k++) at.loss[3][k] = 0.0, at.power[2][k] = old.power[2][k];
            for (int q = 0; q < walls; q++) {
                const int k = wall[q].row;
                const dem_vec v = wall[q].velocity;
                const double power = at.out[0][k] * v.x + at.out[1][k] * v.y + at.out[2][k] * v.z;
                at.loss[3][k] = half * (old.power[2][k] + power);
                at.power[2][k] = power;
            }
        }
        dem__store(&old, &at, n, law, features, run->keeps_wrenches);
        for (ptrdiff_t m = in->marked - marked, q = 0; m < in->marked && h > 0.0; m++) {
            const ptrdiff_t c = contacts->slots[in->first + m];
            const int k = (int)(c - base);
            dem_contact view;
            dem__edge edge;
            double p[DEM_CONSTANTS_MAX];
            if (!contacts->edge[c]) continue;
            while (q < walls && wall[q].row < k) q++;
            for (int a = 0; a < law->constants; a++) p[a] = types->constant[a][k];
            dem__contact_geometry(&b, types, k, half, has_friction, &view, &edge.arm_i, &edge.arm_j);
            view.mass = types->mass[k];
            view.share = dem__mass_share(w, contacts->i[c], contacts->j[c]); /* not the row: see there */
            view.dt = 0.0;
            view.rate = rate;
            view.constants = p;
            view.user = user;
            edge.gap = was[k], edge.force = before[k];
            for (int a = 0; a < law->states && has_friction; a++) edge.state[a] = a < law->history ? past[a][k] : old.state[a][k];
            for (int a = 0; a < 9; a++) edge.out[a] = at.out[a] + k;
            edge.wall_speed = contacts->j[c] < 0 ? wall[q].velocity : dem_vec3(0.0, 0.0, 0.0);
            mend(w, c, &view, &edge);
            for (int a = 0; a < (has_friction ? 9 : 3) && run->keeps_wrenches; a++) old.out[a][k] = at.out[a][k];
        }
        dem__gather_forces(w, chunk, base, n, at.out, has_friction);
    }
}

/* Is a kernel of these features the one for a run with those? The arrays of the ledger must be there, or not. */
DEM_INLINE int dem__suits(int features, int run) {
    return (features & DEM_ENERGY) == (run & DEM_ENERGY) && !(run & ~features & (DEM_FRICTION | DEM_ROLLING));
}

/* The contacts of chunks first .. end-1, by one thread. */
DEM_INLINE void dem__kernel(dem_world *w, ptrdiff_t first, ptrdiff_t end, const dem_law *law, dem__edge_fn *mend, int features) {
    const dem__run *run = &w->engine->run;
    dem__contacts *contacts = &w->engine->contacts;
    dem__type_rows types;
    if (!dem__suits(features, run->features) || law->states != run->law->states || law->constants != run->law->constants) {
        w->status = DEM_BAD_ARGUMENT;
        return;
    }
    for (int k = 0; k < DEM__BLOCK; k++) types.kind[k] = -2;
    for (ptrdiff_t q = first; q < end; q++) {
        contacts->chunk[q].marked = contacts->chunk[q].postponed = 0;
        contacts->chunk[q].low = INT32_MAX, contacts->chunk[q].high = 0;
        for (ptrdiff_t k = 0; k < w->walls; k++) {
            dem__wall_force *push = &contacts->wall_force[q * w->engine->walls.capacity + k];
            push->force = push->torque = dem_vec3(0.0, 0.0, 0.0);
        }
        dem__evaluate_chunk(w, q, &types, law, mend, features);
    }
}

/* Adds what links first .. end-1 do to the loads of their bodies, in their order. */
DEM_INLINE void dem__add_links(dem_world *w, ptrdiff_t first, ptrdiff_t end) {
    dem__bodies *bodies = &w->engine->bodies;
    const dem__links *links = &w->engine->links;
    double *const *out = links->wrench;
    for (ptrdiff_t k = first; k < end; k++) {
        const ptrdiff_t i = links->i[k], j = links->j[k], ahead = k + DEM__AHEAD;
        if (ahead < end) {
            DEM__PREFETCH(bodies->load[links->i[ahead]]);
            DEM__PREFETCH(bodies->load[links->j[ahead] < 0 ? 0 : links->j[ahead]]);
        }
        if (links->ended[k]) continue;
        for (int a = 0; a < 6; a++) bodies->load[i][a] += out[a][k];
        if (j < 0) continue;
        for (int a = 0; a < 3; a++) bodies->load[j][a] -= out[a][k];
        for (int a = 3; a < 6; a++) bodies->load[j][a] += out[3 + a][k];
    }
}

/* The links in slots first .. end-1, from where everything is now. A thread that is alone adds up each block while it is in the cache. */
DEM_INLINE void dem__link_kernel(dem_world *w, ptrdiff_t first, ptrdiff_t end, const dem_law *law) {
    dem__links *links = &w->engine->links;
    const double h = w->engine->run.kernel_dt;
    const void *user = w->user;
    dem__rows b;
    dem__type_rows types; /* of which links have sizes only */
    dem__row state[DEM_STATE_MAX], out[9];
    for (ptrdiff_t base = first; base < end; base += DEM__BLOCK) {
        const int n = end - base < DEM__BLOCK ? (int)(end - base) : DEM__BLOCK;
        dem__wall_row wall[DEM__BLOCK];
        int walls = 0;
        for (int k = 0; k < n; k++) {
            const ptrdiff_t c = base + k, i = links->i[c], j = links->j[c], ahead = c + DEM__AHEAD;
            if (ahead < end) dem__prefetch_particle(w, links->i[ahead]), dem__prefetch_particle(w, links->j[ahead]);
            if (j >= 0) dem__gather_pair(w, i, j, &b, k, 1);
            else dem__gather_wall(w, i, -1 - j, links->element[c], -1, &b, k, 0.0, &wall[walls++]);
            types.sum[k] = w->particle[i].radius + (j >= 0 ? w->particle[j].radius : 0.0);
            types.part[k] = w->particle[i].radius / types.sum[k];
        }
        dem__complete_rows(w, &b, &types, n, 0.0, wall, walls);

        dem__row ended, share;
        dem__columns old, at;
        for (int a = 0; a < law->states; a++) old.state[a] = links->state[a] + base;
        for (int a = 0; a < 9; a++) old.out[a] = links->wrench[a] + base;
        for (int a = 0; a < law->states; a++) at.state[a] = DEM__COPY_ROWS ? state[a] : old.state[a];
        for (int a = 0; a < 9; a++) at.out[a] = DEM__COPY_ROWS ? out[a] : old.out[a];
        for (int k = 0; k < n; k++) share[k] = dem__mass_share(w, links->i[base + k], links->j[base + k]);
        DEM__INDEPENDENT
        for (int k = 0; k < n; k++) {
            dem_contact q;
            dem_response r;
            double s[DEM_STATE_MAX], arm_i = 0.0, arm_j = 0.0;
            for (int a = 0; a < law->states; a++) s[a] = old.state[a][k];
            for (int a = 0; a < law->vectors; a++) dem__turn(&b, k, h, s + 3 * a);
            dem__contact_geometry(&b, &types, k, 0.0, 1, &q, &arm_i, &arm_j);
            q.mass = 0.0;
            q.share = share[k];
            q.dt = h;
            q.rate = 1.0 / h;
            q.constants = NULL;
            q.user = user;
            law->force(&q, s, &r);
            for (int a = 0; a < law->history; a++) at.state[a][k] = s[a];
            ended[k] = r.ended;
            dem__put_force(at.out, k, &q, &r, arm_i, arm_j, DEM_FRICTION);
        }
        const size_t bytes = (size_t)n * sizeof(double);
        for (int a = 0; a < law->history && DEM__COPY_ROWS; a++) memcpy(old.state[a], at.state[a], bytes);
        for (int a = 0; a < 9 && DEM__COPY_ROWS; a++) memcpy(old.out[a], at.out[a], bytes);
        memcpy(links->gap + base, b.gap, bytes);
        for (int k = 0; k < n; k++) links->ended[base + k] = ended[k] != 0.0;
        if (dem__parts(w, links->count) == 1) dem__add_links(w, base, base + n);
    }
}

#define DEM__KERNEL(name, call) DEM__AVX2_CLONE(name, (dem_world * world, ptrdiff_t first, ptrdiff_t end), (world, first, end), call)
#define DEM_KERNEL(name, law, features)                                                                                                    \
    DEM__FAST static DEM__NOINLINE void name##_edge(dem_world *world, ptrdiff_t c, dem_contact *q, const dem__edge *was) {                 \
        dem__correct_edge(world, c, q, was, &(law), features);                                                                             \
    }                                                                                                                                      \
    DEM__KERNEL(name, dem__kernel(world, first, end, &(law), name##_edge, features))
#define DEM_LINK_KERNEL(name, law) DEM__KERNEL(name, dem__link_kernel(world, first, end, &(law)))
