/* Contacts of polyhedra in a block of the kernel. They are contacts of spheres about their points, with torques about
   the centres of the bodies. Reads places of contacts; writes rows and forces of a block. Promises: rows of spheres
   stay as they are. */
#pragma once
#include "../contacts/block.h"

/* Computes the velocity in the middle of a step, and the acceleration, of the point of a body at `arm` from its
   centre. */
DEM_INLINE void dem__point_motion(const dem_world *w, ptrdiff_t i, dem_vec arm, double half, dem_vec *v, dem_vec *a) {
    const dem_particle *p = &w->particle[i];
    const dem_vec round = dem__cross(p->spin, arm);
    *v = dem__add(p->v, dem__cross(p->spin, dem__plus(arm, -half, round))); /* with the arm at that time */
    *a = dem__add(p->a, dem__add(dem__cross(w->spin_rate[i], arm), dem__cross(p->spin, round)));
}

/* Returns the arm at the other body, from the arm at i, the distance of the bodies and the row's normal and gap. */
DEM_INLINE dem_vec dem__other_arm(const dem__rows *b, const dem__type_rows *t, int k, dem_vec arm) {
    const double reach = t->sum[k] + b->gap[k];
    return dem_vec3(arm.x + b->dx[k] - reach * b->nx[k], arm.y + b->dy[k] - reach * b->ny[k],
                    arm.z + b->dz[k] - reach * b->nz[k]);
}

/* Returns a vector whose component along n is larger by a factor 1 + more. */
DEM_INLINE dem_vec dem__speed_up(dem_vec v, dem_vec n, double more) { return dem__plus(v, more * dem__dot(v, n), n); }

/* Calls the law of the run for the springs of row k alone, with these states. */
static inline void dem__spring_of(const dem_world *w, const dem__type_rows *t, int k, double gap, const double *state,
                                  dem_response *r) {
    const dem_law *law = w->engine->run.law;
    dem_contact q;
    double s[DEM_STATE_MAX], constant[DEM_CONSTANTS_MAX];
    memset(&q, 0, sizeof q), memset(r, 0, sizeof *r);
    for (int a = 0; a < law->states; a++) s[a] = state ? state[a] : 0.0;
    for (int a = 0; a < law->constants; a++) constant[a] = t->constant[a][k];
    q.gap = gap, q.normal[2] = 1.0, q.mass = t->mass[k], q.rate = 1.0 / w->engine->run.dt, q.share = 1.0;
    q.constants = constant, q.user = w->user;
    law->force(&q, s, r);
}

/* Adapts the stored friction of the contact in slot c to a change of its weight. A larger weight leaves the force as it
   is, a smaller one the displacement, so the change takes energy and never gives any. Finds how much. */
static inline void dem__fit_friction(const dem_world *w, const dem__type_rows *t, int k, ptrdiff_t c) {
    const dem__contacts *contacts = &w->engine->contacts;
    const dem_law *law = w->engine->run.law;
    const double weight = contacts->touch[DEM__PLACE_WEIGHT][c], was = contacts->touch[DEM__PLACE_WAS][c];
    const double gap = contacts->touch[DEM__PLACE_GAP][c],
                 keep = fabs(weight) > fabs(was) ? fabs(was) / fabs(weight) : 1.0;
    double state[DEM_STATE_MAX], any = 0.0;
    contacts->touch[DEM__PLACE_WAS][c] = 0.0;
    if (weight == was || !(gap < 0.0)) return;
    for (int a = 0; a < law->states; a++)
        state[a] = contacts->state[a][c], any += a < 3 * law->vectors ? fabs(state[a]) : 0.0;
    if (any == 0.0) return;
    if (w->engine->ledger.on) {
        dem_response with, without;
        dem__spring_of(w, t, k, gap, state, &with), dem__spring_of(w, t, k, gap, NULL, &without);
        contacts->touch[DEM__PLACE_WAS][c] = (was - keep * keep * weight) * (with.elastic - without.elastic);
    }
    for (int a = 0; a < 3 * law->vectors; a++) contacts->state[a][c] = keep * state[a];
}

/* Fills row k of a polyhedron's contact with another body or a wall. */
static inline void dem__fill_convex_row(const dem_world *w, dem__rows *b, const dem__type_rows *t, int k, ptrdiff_t c,
                                        double half, dem__wall_row *at) {
    const ptrdiff_t i = w->engine->contacts.i[c], j = w->engine->contacts.j[c];
    const dem_vec n = dem__place_normal(w, c), arm = dem__place_arm(w, c), before = dem__place_before(w, c);
    dem_vec v, a, other_v, other_a, spin;
    b->nx[k] = n.x, b->ny[k] = n.y, b->nz[k] = n.z, b->gap[k] = w->engine->contacts.touch[DEM__PLACE_GAP][c];
    b->inverse[k] = 1.0 / (t->sum[k] + b->gap[k]);
    dem__point_motion(w, i, arm, half, &v, &a);
    if (j >= 0) {
        dem__point_motion(w, j, dem__other_arm(b, t, k, arm), half, &other_v, &other_a);
        spin = w->particle[j].spin;
    } else {
        const dem_wall *wall = at->wall;
        const dem_vec point = dem__add(w->particle[i].x, dem__plus(arm, -(t->sum[k] + b->gap[k]), n));
        other_v = wall->slides ? dem__surface_velocity(wall, point, n) : wall->velocity;
        other_a = wall->slides ? dem__surface_acceleration(wall, point) : wall->acceleration;
        spin = dem__scale(wall->spin, wall->spin_axis);
        at->velocity = other_v;
        other_v = dem__plus(other_v, -half, other_a);
    }
    const double more = w->engine->contacts.touch[DEM__PLACE_DAMPING][c] - 1.0; /* of the speed along the normal */
    const dem_vec dv = dem__speed_up(dem__sub(v, other_v), n, more), da = dem__speed_up(dem__sub(a, other_a), n, more),
                  turned = dem__scale(half > 0.0 ? 0.5 : 0.0, dem__sub(n, before));
    b->vx[k] = dv.x, b->vy[k] = dv.y, b->vz[k] = dv.z, b->ax[k] = da.x, b->ay[k] = da.y, b->az[k] = da.z;
    b->wi[0][k] = w->particle[i].spin.x, b->wi[1][k] = w->particle[i].spin.y, b->wi[2][k] = w->particle[i].spin.z;
    b->wj[0][k] = spin.x, b->wj[1][k] = spin.y, b->wj[2][k] = spin.z;
    b->tx[k] = turned.x, b->ty[k] = turned.y, b->tz[k] = turned.z;
}
static DEM__NOINLINE void dem__fill_convex_rows(const dem_world *w, dem__rows *b, const dem__type_rows *t,
                                                ptrdiff_t base, int n, double half, dem__wall_row *wall) {
    for (int k = 0, q = 0; k < n; k++) {
        const int at_wall = w->engine->contacts.j[base + k] < 0;
        if (dem__is_convex_contact(w, base + k)) {
            if (!w->engine->run.only_ledger) dem__fit_friction(w, t, k, base + k);
            dem__fill_convex_row(w, b, t, k, base + k, half, at_wall ? &wall[q] : NULL);
        }
        q += at_wall;
    }
}

/* Adds to row k its part of the force by which the springs of its pair exceed the sum of their parts in the law. */
static inline void dem__pull(const dem_world *w, const dem__type_rows *t, ptrdiff_t c, double *const *out, int k) {
    const double part = w->engine->contacts.touch[DEM__PLACE_PULL][c],
                 *pull = w->engine->convex.pair[-2 - w->engine->contacts.near[c]].pull;
    dem_response spring;
    if (part == 0.0) return;
    dem__spring_of(w, t, k, w->engine->contacts.touch[DEM__PLACE_GAP][c], NULL, &spring);
    for (int a = 0; a < 9; a++) out[a][k] += part * spring.contact * pull[a];
}

/* Multiplies a block's forces by their weights, and adds torques about the centres of its bodies. */
static DEM__NOINLINE void dem__finish_convex_rows(const dem_world *w, const dem__rows *b, const dem__type_rows *t,
                                                  ptrdiff_t base, int n, const dem__columns *at, const double *before,
                                                  double half, int features) {
    const dem__contacts *contacts = &w->engine->contacts;
    double *const *out = at->out;
    for (int k = 0; k < n; k++) {
        const ptrdiff_t c = base + k;
        if (!dem__is_convex_contact(w, c)) continue;
        const double weight = contacts->touch[DEM__PLACE_WEIGHT][c],
                     power = weight / contacts->touch[DEM__PLACE_DAMPING][c]; /* from the true speed */
        const dem_vec arm = dem__place_arm(w, c), other = dem__other_arm(b, t, k, arm);
        const dem_vec f = dem__scale(weight, dem_vec3(out[0][k], out[1][k], out[2][k])), on_i = dem__cross(arm, f),
                      on_j = dem__cross(other, f);
        out[0][k] = f.x, out[1][k] = f.y, out[2][k] = f.z;
        out[3][k] = weight * out[3][k] + on_i.x, out[6][k] = weight * out[6][k] - on_j.x;
        out[4][k] = weight * out[4][k] + on_i.y, out[7][k] = weight * out[7][k] - on_j.y;
        out[5][k] = weight * out[5][k] + on_i.z, out[8][k] = weight * out[8][k] - on_j.z;
        if (!w->engine->run.only_ledger) dem__pull(w, t, c, out, k);
        if (!(features & DEM_ENERGY)) continue;
        /* losses are means of the power before, which has its weight, and of the power now; without a force, the energy
           of the spring is lost */
        if (fabs(before[k]) + fabs(at->force[k]) == 0.0) at->loss[0][k] -= (weight - 1.0) * at->elastic[k];
        else at->loss[0][k] += (power - 1.0) * half * at->power[0][k];
        at->loss[2][k] += (weight - 1.0) * half * at->power[1][k];
        at->elastic[k] *= weight, at->loss[1][k] *= weight;
        if (!w->engine->run.only_ledger) at->loss[1][k] += contacts->touch[DEM__PLACE_WAS][c];
        at->power[0][k] *= power, at->power[1][k] *= weight;
    }
}

/* Excludes polyhedra from the correction of partial steps, among the last `marked` contacts in a chunk's list: the mass
   at a corner is not the pair's. */
static inline void dem__exclude_convex(dem_world *w, const dem__chunk *in, ptrdiff_t marked) {
    dem__contacts *contacts = &w->engine->contacts;
    for (ptrdiff_t m = in->marked - marked; m < in->marked; m++) {
        const ptrdiff_t c = contacts->slots[in->first + m];
        if (dem__is_convex_contact(w, c)) contacts->partial[c] = 0;
    }
}

/* Sets what a law needs for a contact of polyhedra: the radii of the roundings, mass and curvature at its point. */
static inline void dem__prepare_convex(const dem_world *w, ptrdiff_t c, dem_birth *b) {
    const ptrdiff_t i = w->engine->contacts.i[c], j = w->engine->contacts.j[c];
    b->radius_i = dem__touching_radius(w, i);
    b->mass = 1.0 / (dem__per_mass(w, i) + (j >= 0 ? dem__per_mass(w, j) : 0.0));
    if (j >= 0) b->radius_j = dem__touching_radius(w, j);
    else b->curvature = w->engine->contacts.touch[DEM__PLACE_CURVATURE][c];
}
