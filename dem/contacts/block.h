/* A block of contacts as rows of numbers: gathered from bodies, walls and contact types, completed, and stored. Reads
   bodies, walls and contacts; writes contacts through columns. Promises: what it writes of a contact depends only on
   that contact and its bodies. */
#pragma once
#include "../search/neighbour_list.h"

/* Geometry and motion of a block of contacts, before the law is called. */
typedef struct dem__rows {
    dem__row dx, dy, dz;             /* from the centre of j, or from the axis of a round wall, to the centre of i */
    dem__row vx, vy, vz, ax, ay, az; /* relative velocity in the middle of the step, relative acceleration */
    dem__row wi[3], wj[3];           /* spins */
    dem__row nx, ny, nz, gap, inverse;
    dem__row tx, ty, tz; /* change of the normal since the middle of the step */
} dem__rows;

/* Constants of a block of contacts. Kept from block to block, because most contacts are of the same types. */
typedef struct dem__type_rows {
    int32_t kind[DEM__BLOCK]; /* contact type of the row; -1: constants of its own; -2: empty */
    dem__row mass, predict, sum, part, constant[DEM_CONSTANTS_MAX];
} dem__type_rows;

/* Computes the geometry of contact k for the law. half: half of the step [s]. lag: a constant, 0 for links, whose
   velocities and spins belong to the same time as the rows' positions. */
DEM_INLINE void dem__contact_geometry(const dem__rows *b, const dem__type_rows *t, int k, double half, double lag,
                                      int has_friction, dem_contact *q, double *arm_i, double *arm_j) {
    const double nx = b->nx[k], ny = b->ny[k], nz = b->nz[k];
    const double along = b->vx[k] * nx + b->vy[k] * ny + b->vz[k] * nz;
    q->normal[0] = nx, q->normal[1] = ny, q->normal[2] = nz;
    q->gap = b->gap[k];
    q->closing = -along - half * (b->ax[k] * nx + b->ay[k] * ny + b->az[k] * nz);
    if (!has_friction) return;
    /* the arms D r_i/(r_i + r_j) add up to the distance D, which conserves angular momentum */
    const double distance = t->sum[k] + b->gap[k], ai = t->part[k] * distance, aj = (1.0 - t->part[k]) * distance;
    const double sx = ai * b->wi[0][k] + aj * b->wj[0][k], sy = ai * b->wi[1][k] + aj * b->wj[1][k],
                 sz = ai * b->wi[2][k] + aj * b->wj[2][k];
    *arm_i = ai, *arm_j = aj;
    /* velocities and spins are those of the middle of the step, so the slip is computed with the normal at that
       time, n - t; otherwise a rolling contact whose normal turns would gain energy. Terms of second order in t are
       left out. */
    const double tx = lag * b->tx[k], ty = lag * b->ty[k], tz = lag * b->tz[k];
    const double sn = sx * nx + sy * ny + sz * nz, lx = sx + sn * tx, ly = sy + sn * ty, lz = sz + sn * tz;
    q->translation[0] = b->vx[k] - along * (nx - tx), q->translation[1] = b->vy[k] - along * (ny - ty);
    q->translation[2] = b->vz[k] - along * (nz - tz);
    q->slip[0] = q->translation[0] + (ny * lz - nz * ly);
    q->slip[1] = q->translation[1] + (nz * lx - nx * lz);
    q->slip[2] = q->translation[2] + (nx * ly - ny * lx);
    q->spin[0] = b->wi[0][k] - b->wj[0][k], q->spin[1] = b->wi[1][k] - b->wj[1][k],
    q->spin[2] = b->wi[2][k] - b->wj[2][k];
}

/* Turns a tangential vector of the history with the contact: from the old normal to the new one, to second order and
   without a root, and about the normal with the mean spin. */
DEM_INLINE void dem__turn(const dem__rows *b, int k, double h, double *s) {
    const double nx = b->nx[k], ny = b->ny[k], nz = b->nz[k];
    const double bx = nx - b->tx[k], by = ny - b->ty[k],
                 bz = nz - b->tz[k]; /* half way between the old normal and the new */
    const double twist =
        0.5 * h *
        ((b->wi[0][k] + b->wj[0][k]) * nx + (b->wi[1][k] + b->wj[1][k]) * ny + (b->wi[2][k] + b->wj[2][k]) * nz);
    const double x = s[0], y = s[1], z = s[2], out = x * nx + y * ny + z * nz;
    s[0] = x - out * bx + twist * (ny * z - nz * y);
    s[1] = y - out * by + twist * (nz * x - nx * z);
    s[2] = z - out * bz + twist * (nx * y - ny * x);
}

/* Where the entries of a block's first contact are: in the arrays of contacts, or in the block's rows. */
typedef struct dem__columns {
    double *state[DEM_STATE_MAX], *out[9], *gap, *force, *elastic, *power[3], *loss[4];
} dem__columns;

/* Results of a block of contacts that are not written directly to the contacts. */
typedef struct dem__block_rows {
    dem__row state[DEM_STATE_MAX], out[9], gap, force, elastic, power[3], loss[4];
} dem__block_rows;

DEM_INLINE void dem__columns_of(const dem_world *w, ptrdiff_t c, const dem_law *law, int features, dem__columns *at) {
    const dem__contacts *contacts = &w->engine->contacts;
    for (int a = 0; a < law->states; a++) at->state[a] = contacts->state[a] + c;
    for (int a = 0; a < 9; a++) at->out[a] = contacts->wrench[a] + c;
    at->gap = contacts->gap + c, at->force = contacts->force + c;
    at->elastic = NULL;
    if (!(features & DEM_ENERGY)) return;
    for (int a = 0; a < 3; a++) at->power[a] = contacts->power[a] + c;
    for (int a = 0; a < 4; a++) at->loss[a] = contacts->loss[a] + c;
    at->elastic = contacts->elastic + c;
}

/* Sets where the results of a block go. Forces go into the block's rows, because few runs keep them. The rest goes
   directly to the contacts or, with `copies`, into rows. */
DEM_INLINE void dem__new_columns(const dem_world *w, ptrdiff_t c, const dem_law *law, int features, int copies,
                                 dem__block_rows *b, dem__columns *at) {
    dem__columns_of(w, c, law, features, at);
    for (int a = 0; a < 9; a++) at->out[a] = b->out[a];
    if (!copies) return;
    for (int a = 0; a < DEM_STATE_MAX; a++) at->state[a] = b->state[a];
    for (int a = 0; a < 3; a++) at->power[a] = b->power[a];
    for (int a = 0; a < 4; a++) at->loss[a] = b->loss[a];
    at->gap = b->gap, at->force = b->force, at->elastic = b->elastic;
}

/* Copies the energies of a block from its rows to the contacts. */
DEM_INLINE void dem__store_ledger(const dem__columns *to, const dem__columns *from, int n) {
    const size_t bytes = (size_t)n * sizeof(double);
    for (int a = 0; a < 3; a++) memcpy(to->power[a], from->power[a], bytes);
    for (int a = 0; a < 4; a++) memcpy(to->loss[a], from->loss[a], bytes);
    memcpy(to->elastic, from->elastic, bytes);
}

/* Copies a block's results from its rows to the contacts. */
DEM_INLINE void dem__store(const dem__columns *to, const dem__columns *from, int n, const dem_law *law, int features,
                           int keeps_out) {
    const size_t bytes = (size_t)n * sizeof(double);
    for (int a = 0; a < (features & DEM_FRICTION ? 9 : 3) && keeps_out; a++) memcpy(to->out[a], from->out[a], bytes);
    if (!DEM__COPY_ROWS) return;
    for (int a = 0; a < law->history; a++) memcpy(to->state[a], from->state[a], bytes);
    memcpy(to->gap, from->gap, bytes), memcpy(to->force, from->force, bytes);
    if (features & DEM_ENERGY) dem__store_ledger(to, from, n);
}

/* Copies the constants of a block of contacts that have constants of their own. */
static inline void dem__copy_types(const dem_world *w, ptrdiff_t base, int n, int constants, dem__type_rows *t) {
    const dem__contacts *contacts = &w->engine->contacts;
    const size_t bytes = (size_t)n * sizeof(double);
    memcpy(t->mass, contacts->mass + base, bytes), memcpy(t->predict, contacts->predict + base, bytes);
    memcpy(t->sum, contacts->sum + base, bytes), memcpy(t->part, contacts->part + base, bytes);
    for (int a = 0; a < constants; a++) memcpy(t->constant[a], contacts->constant[a] + base, bytes);
    for (int k = 0; k < n; k++) t->kind[k] = -1;
}

/* Loads the constants of those rows whose contact type differs from that of the block before. */
DEM__FAST static DEM__NOINLINE void dem__renew_types(const dem_world *w, ptrdiff_t base, int n, int constants,
                                                     dem__type_rows *t) {
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

/* Computes the force on i and the torques on i and j, and stores them at index c of `out`. */
DEM_INLINE void dem__put_force(double *const *out, ptrdiff_t c, const dem_contact *q, const dem_response *r,
                               double arm_i, double arm_j, int features) {
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

/* Computes the losses of a step from powers by the trapezoidal rule. A contact without a force before and after loses
   the energy of its spring. */
DEM_INLINE void dem__put_losses(const dem__columns *at, const dem__columns *old, ptrdiff_t c, const dem_response *r,
                                double h, double contact_before) {
    const double unloaded = old->elastic[c] - r->elastic, damped = 0.5 * h * (old->power[0][c] + r->normal_power);
    at->loss[0][c] = fabs(contact_before) + fabs(r->contact) == 0.0 ? unloaded : damped;
    at->loss[1][c] = r->slide_loss;
    at->loss[2][c] = 0.5 * h * (old->power[1][c] + r->rolling_power);
    at->power[0][c] = r->normal_power;
    at->power[1][c] = r->rolling_power;
    at->elastic[c] = r->elastic;
}

/* Finds where a wall is touched by the contact in a slot, or by a link (slot -1). */
DEM_INLINE void dem__touch_place(const dem_world *w, ptrdiff_t slot, const dem_wall *wall, dem_vec x, double radius,
                                 int32_t element, dem__touch *touch) {
    if (dem__has(wall, DEM__HALF_SPACE)) dem__touch_flat(wall, dem__sub(x, wall->position), radius, touch);
    else if (slot >= 0 && dem__has(wall, DEM__TRIANGULATED)) {
        touch->normal = dem__place_normal(w, slot);
        touch->gap = w->engine->contacts.touch[DEM__PLACE_GAP][slot];
    } else dem__touch_element(wall, x, radius, element, touch);
}

/* A row of a block that is at a wall. */
typedef struct dem__wall_row {
    const dem_particle *particle;
    const dem_wall *wall;
    int row;
    dem_vec from, velocity; /* round wall: from its axis to the centre [m]; velocity of the wall at the contact [m/s] */
    ptrdiff_t slot;         /* of the contact; -1: of a link */
    int32_t element;
    double outside,
        inner; /* round wall: 1, or -1 from inside, and its radius [m]; other walls: 0, and touch is known */
    dem__touch touch;
} dem__wall_row;

/* Gathers row k: particle i at an element of a wall, for the contact in a slot or a link (-1). A round wall is treated
   like another sphere: dem__complete_rows computes its root and quotient. */
static DEM__NOINLINE void dem__gather_wall(const dem_world *w, ptrdiff_t i, ptrdiff_t number, int32_t element,
                                           ptrdiff_t slot, dem__rows *b, int k, double half, dem__wall_row *at) {
    const dem_wall *wall = &w->wall[number];
    const dem_particle *s = &w->particle[i];
    at->particle = s, at->wall = wall, at->row = k, at->velocity = wall->velocity, at->slot = slot,
    at->element = element;
    if (slot >= 0 && dem__is_convex_contact(w, slot)) { /* dem__fill_convex_rows replaces this */
        at->outside = 0.0, at->from = dem_vec3(1.0, 0.0, 0.0), at->touch.normal = wall->axis[2], at->touch.gap = 0.0;
    } else if ((at->outside = dem__reach_round(wall, s->x, element, &at->from, &at->inner)) == 0.0) {
        dem__touch_place(w, slot, wall, s->x, s->radius, element, &at->touch);
        at->from = dem_vec3(s->radius + at->touch.gap, 0.0, 0.0);
    }
    b->dx[k] = at->from.x, b->dy[k] = at->from.y, b->dz[k] = at->from.z;
    b->vx[k] = s->v.x - (wall->velocity.x - half * wall->acceleration.x);
    b->vy[k] = s->v.y - (wall->velocity.y - half * wall->acceleration.y);
    b->vz[k] = s->v.z - (wall->velocity.z - half * wall->acceleration.z);
    b->ax[k] = s->a.x - wall->acceleration.x, b->ay[k] = s->a.y - wall->acceleration.y,
    b->az[k] = s->a.z - wall->acceleration.z;
    b->wi[0][k] = s->spin.x, b->wi[1][k] = s->spin.y, b->wi[2][k] = s->spin.z;
    b->wj[0][k] = b->wj[1][k] = b->wj[2][k] = 0.0;
}

/* Replaces the velocities of a row by those relative to the wall's surface at the contact, where the surface does not
   move as a whole. */
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

DEM_INLINE void dem__gather_pair(const dem_particle *particle, ptrdiff_t i, ptrdiff_t j, dem__rows *b, int k,
                                 int has_friction) {
    const dem_particle *p = &particle[i], *q = &particle[j];
    b->dx[k] = p->x.x - q->x.x, b->dy[k] = p->x.y - q->x.y, b->dz[k] = p->x.z - q->x.z;
    b->vx[k] = p->v.x - q->v.x, b->vy[k] = p->v.y - q->v.y, b->vz[k] = p->v.z - q->v.z;
    b->ax[k] = p->a.x - q->a.x, b->ay[k] = p->a.y - q->a.y, b->az[k] = p->a.z - q->a.z;
    if (!has_friction) return;
    b->wi[0][k] = p->spin.x, b->wi[1][k] = p->spin.y, b->wi[2][k] = p->spin.z;
    b->wj[0][k] = q->spin.x, b->wj[1][k] = q->spin.y, b->wj[2][k] = q->spin.z;
}

/* Returns the mass share of a contact: the smaller one of i and j, or that of i at a wall. */
DEM_INLINE double dem__mass_share(const dem_world *w, ptrdiff_t i, ptrdiff_t j) {
    const double a = w->engine->bodies.mass_share[i], b = w->engine->bodies.mass_share[j < 0 ? i : j];
    return a < b ? a : b;
}

/* Replaces differences of positions by those of nearest images. Active particles lie within the periodic box. */
DEM_INLINE void dem__wrap_row(double *row, int n, double length) {
    for (int k = 0; k < n; k++) row[k] = dem__image(row[k], length);
}

/* Completes normal and gap of a row at a wall. */
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

/* Computes the change of the normal at a wall: the sphere moves over the wall, and the wall turns. */
static DEM__NOINLINE void dem__turn_at_wall(const dem_world *w, dem__rows *b, double half, double turn,
                                            const dem__wall_row *at) {
    const int k = at->row;
    const dem_wall *wall = at->wall;
    const dem_particle *s = at->particle;
    const dem_vec n = dem_vec3(b->nx[k], b->ny[k], b->nz[k]);
    dem_vec t;
    if (dem__has(wall, DEM__TRIANGULATED) &&
        at->slot >= 0) { /* between edges and faces: only the contact knows both normals */
        t = dem__scale(half > 0.0 ? 0.5 : 0.0, dem__sub(n, dem__place_before(w, at->slot)));
    } else {
        dem_vec u = dem_vec3(b->vx[k], b->vy[k], b->vz[k]);
        if (wall->slides) { /* u is relative to the wall's surface, not to its frame */
            dem_vec carried = dem__plus(wall->velocity, -half, wall->acceleration);
            const dem_vec spin = dem__scale(wall->spin, wall->spin_axis);
            if (wall->spin != 0.0) carried = dem__add(carried, dem__cross(spin, dem__sub(s->x, wall->position)));
            u = dem__sub(s->v, carried);
        }
        t = dem__normal_rate(wall, s->x, s->radius, at->element, n, b->inverse[k], u);
        if (wall->spin != 0.0) t = dem__add(t, dem__cross(dem__scale(wall->spin, wall->spin_axis), n));
        t = dem__scale(turn, t);
    }
    b->tx[k] = t.x, b->ty[k] = t.y, b->tz[k] = t.z;
}

/* Computes nearest images, normals and gaps of a block. With friction, also the changes of the normals in the time
   `turn` before the end of the step (links: half the time since their last evaluation). `walls` of the rows are at
   walls. */
DEM_INLINE void dem__complete_rows(const dem_world *w, dem__rows *b, const dem__type_rows *t, int n, double half,
                                   double turn, dem__wall_row *wall, int walls, int has_friction) {
    if (w->def.periodic[0]) dem__wrap_row(b->dx, n, w->def.high.x - w->def.low.x);
    if (w->def.periodic[1]) dem__wrap_row(b->dy, n, w->def.high.y - w->def.low.y);
    if (w->def.periodic[2]) dem__wrap_row(b->dz, n, w->def.high.z - w->def.low.z);
    for (int q = 0; q < walls && w->engine->run.has_periodic; q++) { /* walls have no images */
        const int k = wall[q].row;
        b->dx[k] = wall[q].from.x, b->dy[k] = wall[q].from.y, b->dz[k] = wall[q].from.z;
    }
    for (int k = 0; k < n; k++) {
        const double distance = sqrt(b->dx[k] * b->dx[k] + b->dy[k] * b->dy[k] + b->dz[k] * b->dz[k]),
                     inverse = 1.0 / distance;
        const double nx = b->dx[k] * inverse, ny = b->dy[k] * inverse, nz = b->dz[k] * inverse;
        b->nx[k] = nx, b->ny[k] = ny, b->nz[k] = nz;
        b->inverse[k] = inverse;
        b->gap[k] = distance - t->sum[k];
        if (!has_friction) continue;
        const double by = turn * inverse, along = b->vx[k] * nx + b->vy[k] * ny + b->vz[k] * nz;
        b->tx[k] = by * (b->vx[k] - along * nx), b->ty[k] = by * (b->vy[k] - along * ny),
        b->tz[k] = by * (b->vz[k] - along * nz);
    }
    for (int q = 0; q < walls; q++) {
        const int k = wall[q].row;
        dem__complete_wall(b, half, &wall[q]);
        if (!has_friction) continue;
        if (dem__has(wall[q].wall, DEM__HALF_SPACE) && wall[q].wall->spin == 0.0) b->tx[k] = b->ty[k] = b->tz[k] = 0.0;
        else dem__turn_at_wall(w, b, half, turn, &wall[q]);
    }
}
