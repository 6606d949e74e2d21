/* ---------------------------------------------------------------------------------------------- >>geometry */

DEM_INLINE dem_vec dem__add(dem_vec a, dem_vec b) { return dem_vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
DEM_INLINE dem_vec dem__sub(dem_vec a, dem_vec b) { return dem_vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
DEM_INLINE dem_vec dem__scale(double s, dem_vec a) { return dem_vec3(s * a.x, s * a.y, s * a.z); }
DEM_INLINE dem_vec dem__plus(dem_vec a, double s, dem_vec b) { return dem_vec3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z); }
DEM_INLINE double dem__dot(dem_vec a, dem_vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
DEM_INLINE dem_vec dem__cross(dem_vec a, dem_vec b) {
    return dem_vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
DEM_INLINE double dem__length(dem_vec a) { return sqrt(dem__dot(a, a)); }

/* Rotation of v by an angle [rad] about a unit axis (Rodrigues). */
static inline dem_vec dem__rotated(dem_vec v, dem_vec axis, double angle) {
    double turns = angle / (2.0 * RIDDLE_PI), phase = 2.0 * RIDDLE_PI * (turns - floor(turns));
    double s = riddle_sin(phase), c = riddle_cos(phase);
    return dem__add(dem__add(dem__scale(c, v), dem__scale(s, dem__cross(axis, v))), dem__scale((1.0 - c) * dem__dot(axis, v), axis));
}

DEM_INLINE double dem__vibration(double amplitude, double phase, double turns, double rate, double *velocity, double *acceleration) {
    if (amplitude == 0.0) {
        *velocity = *acceleration = 0.0;
        return 0.0;
    }
    double angle = 2.0 * RIDDLE_PI * (turns - floor(turns)) + phase, s = riddle_sin(angle);
    *velocity = amplitude * rate * riddle_cos(angle);
    *acceleration = -amplitude * rate * rate * s;
    return amplitude * (phase == 0.0 ? s : s - riddle_sin(phase));
}

/* What vibration does to a wall. */
typedef struct dem__sway {
    dem_vec shift, velocity, acceleration;
} dem__sway;
static inline dem__sway dem__sway_at(const dem_wall *w, double t) {
    const double rate = 2.0 * RIDDLE_PI * w->frequency, turns = w->frequency * t;
    dem__sway s;
    s.shift.x = dem__vibration(w->amplitude.x, w->phase.x, turns, rate, &s.velocity.x, &s.acceleration.x);
    s.shift.y = dem__vibration(w->amplitude.y, w->phase.y, turns, rate, &s.velocity.y, &s.acceleration.y);
    s.shift.z = dem__vibration(w->amplitude.z, w->phase.z, turns, rate, &s.velocity.z, &s.acceleration.z);
    return s;
}

/* Do two walls vibrate as one, as a deck and its side wall do? */
DEM_INLINE int dem__sways_with(const dem_wall *a, const dem_wall *b) {
    return memcmp(&a->amplitude, &b->amplitude, sizeof a->amplitude) == 0 && memcmp(&a->phase, &b->phase, sizeof a->phase) == 0 &&
           a->frequency == b->frequency && a->motion_start == b->motion_start;
}

/* The frame and place that a pose gives a wall. */
static inline dem_vec dem__posed(const dem_wall *w, const dem_pose *pose, dem_vec *axis) {
    const double angle = dem__length(pose->turn);
    dem_vec arm = dem__sub(w->origin, w->spin_centre);
    for (int k = 0; k < 3; k++) axis[k] = w->rest_axis[k];
    if (angle != 0.0) { /* NaN goes on */
        const dem_vec about = dem__scale(1.0 / angle, pose->turn);
        for (int k = 0; k < 3; k++) axis[k] = dem__rotated(axis[k], about, angle);
        arm = dem__rotated(arm, about, angle);
    }
    return dem__add(dem__add(w->spin_centre, arm), pose->shift);
}

static inline void dem__prescribed_wall(dem_wall *w, double time) {
    dem_vec at[3], axis[3][3], omega = dem_vec3(0.0, 0.0, 0.0);
    const double rate = 0.5 / w->interval;
    if (!w->motion) return;
    for (int k = 0; k < 3; k++) {
        dem_pose pose;
        memset(&pose, 0, sizeof pose);
        w->motion(w->motion_user, time + (k - 1) * w->interval, &pose);
        at[k] = dem__posed(w, &pose, axis[k]);
    }
    for (int k = 0; k < 3; k++) { /* w = sum of a x da/dt over the axes, halved */
        w->axis[k] = axis[1][k];
        omega = dem__add(omega, dem__scale(0.5 * rate, dem__cross(axis[1][k], dem__sub(axis[2][k], axis[0][k]))));
    }
    w->position = at[1];
    w->velocity = dem__scale(rate, dem__sub(at[2], at[0]));
    w->acceleration = dem__scale(4.0 * rate * rate, dem__sub(dem__add(at[0], at[2]), dem__scale(2.0, at[1])));
    w->spin = dem__length(omega);
    if (w->spin > 0.0) w->spin_axis = dem__scale(1.0 / w->spin, omega);
}

/* Velocity and acceleration that a controlled wall's rate gives it where it is. */
static inline void dem__rated_wall(dem_wall *w, double rate) {
    if (w->drive == DEM_FORCE_CONTROLLED) {
        w->velocity = dem__scale(rate, w->spin_axis), w->acceleration = dem__scale(w->rate_change, w->spin_axis);
        return;
    }
    const dem_vec arm = dem__sub(w->position, w->spin_centre), across = dem__cross(w->spin_axis, arm);
    w->spin = rate, w->spin_rate = w->rate_change;
    w->velocity = dem__scale(rate, across);
    w->acceleration = dem__add(dem__scale(w->rate_change, across), dem__scale(rate, dem__cross(w->spin_axis, w->velocity)));
}

/* Predicted, as a particle is. */
static inline void dem__controlled_wall(dem_wall *w, double time) {
    const double tau = time - w->motion_start, way = w->coordinate + tau * (w->rate + 0.5 * tau * w->rate_change);
    dem_pose pose;
    memset(&pose, 0, sizeof pose);
    if (w->drive == DEM_FORCE_CONTROLLED) pose.shift = dem__scale(way, w->spin_axis);
    else pose.turn = dem__scale(way, w->spin_axis);
    w->position = dem__posed(w, &pose, w->axis);
    dem__rated_wall(w, w->rate + tau * w->rate_change);
}

/* Puts a kinematic wall where it is t after its motion began. */
static inline void dem__kinematic_wall(dem_wall *w, double t, const dem__sway *sway) {
    const dem_vec shift = dem__add(sway->shift, dem__scale(t, w->drift));
    w->velocity = dem__add(sway->velocity, w->drift);
    w->acceleration = sway->acceleration;
    dem_vec origin = w->origin;
    if (w->spin != 0.0) {
        double angle = w->spin * t;
        for (int k = 0; k < 3; k++) w->axis[k] = dem__rotated(w->rest_axis[k], w->spin_axis, angle);
        dem_vec arm = dem__rotated(dem__sub(w->origin, w->spin_centre), w->spin_axis, angle), omega = dem__scale(w->spin, w->spin_axis);
        dem_vec turning = dem__cross(omega, arm);
        origin = dem__add(w->spin_centre, arm);
        w->velocity = dem__add(w->velocity, turning);
        w->acceleration = dem__add(w->acceleration, dem__cross(omega, turning));
    }
    w->position = dem__add(origin, shift);
}

/* Puts a wall where it is at a time. */
static inline void dem__move_wall(dem_wall *w, double time) {
    if (w->drive == DEM_PRESCRIBED) dem__prescribed_wall(w, time);
    else if (w->drive != DEM_KINEMATIC) dem__controlled_wall(w, time);
    else {
        const dem__sway sway = dem__sway_at(w, time - w->motion_start);
        dem__kinematic_wall(w, time - w->motion_start, &sway);
    }
}

/* One place where a sphere is near a wall. */
typedef struct dem__touch {
    double gap, curvature;
    dem_vec normal; /* from the wall to the sphere */
    int32_t element;
    int32_t face; /* mesh: the triangle above whose inside the centre is, -1 beyond its edges */
} dem__touch;

/* The face on which a contact with a mesh rests: it stays the one place that is touched while the centre is within `slack` of `at` and what
   a contact opens by in a step is less than that. */
typedef struct dem__footing {
    dem_vec at;   /* in the wall's own frame */
    double slack; /* [m]; 0: search */
    int32_t face;
} dem__footing;

enum { DEM__TOUCHES = 4, DEM__NUMBERS = 16 }; /* NUMBERS: of the contacts of a particle with a mesh, those that end this step included */
#define DEM__SMOOTH 0.9 /* cosine of the angle, 26 degrees, up to which facets are one surface: a drum of 16 sides is round */

DEM_INLINE double dem__clamp(double v, double low, double high) { return v < low ? low : (v > high ? high : v); }

/* From the nearest point of the axis of bar `index` of a family, at (index - 1/2) pitch, to a centre: along is its coordinate parallel to
   the bars, across the one over them; (along, across, up) is left in *from. How far from there the surface is, or less than 0 if there is
   no such bar. */
DEM_INLINE double dem__reach_bar(const dem_wall *w, int family, double index, double along, double across, double up, dem_vec *from) {
    const double half = 0.5 * w->wire, bar = (index - 0.5) * (w->aperture + w->wire);
    const double side = family ? w->half_x : w->half_y, length = family ? w->half_y : w->half_x;
    const double end2 = w->circular ? (w->half_x - bar) * (w->half_x + bar) : length * length; /* its half length, squared */
    const int beyond = !(along * along <= end2);
    const double da = !beyond ? 0.0 : along < 0.0 ? along + sqrt(end2) : along - sqrt(end2), dc = across - bar;
    *from = dem_vec3(da, dc, up);
    if (w->circular ? !(fabs(bar) < w->half_x) : !(fabs(bar) <= side)) return -1.0;
    if (w->profile == DEM_ROUND || !(up < 0.0)) return half;
    /* the flat side: as wide as the wire and, seen from below, as round at its ends */
    if (!beyond) {
        from->y = dc - dem__clamp(dc, -half, half);
        return 0.0;
    }
    const double out_by = sqrt(da * da + dc * dc), rest = out_by > half ? (out_by - half) / out_by : 0.0;
    from->x = rest * da, from->y = rest * dc;
    return 0.0;
}

/* Bar `index` of a family as a place that is touched; the normal is left in (along, across, up). Returns 0 if there is no such bar. */
DEM_INLINE int dem__touch_bar(const dem_wall *w, int family, double index, double along, double across, double up, double radius,
                              dem__touch *out) {
    dem_vec from;
    const double inner = dem__reach_bar(w, family, index, along, across, up, &from);
    if (!(inner >= 0.0)) return 0;
    const double distance = dem__length(from);
    out->gap = distance - inner - radius;
    out->curvature = 1.0 / w->wire; /* of the round part everywhere: a contact's constants do not depend on when they are asked for */
    out->normal = dem__scale(1.0 / distance, from);
    out->element = 2 * (int32_t)index + family;
    return distance > 0.0;
}

/* (along, across, up) of a family to the world's axes. */
DEM_INLINE dem_vec dem__from_bar(const dem_wall *w, int family, dem_vec v) {
    const dem_vec a = dem__scale(v.x, w->axis[family]), c = dem__scale(v.y, w->axis[1 - family]), u = dem__scale(v.z, w->axis[2]);
    return dem__add(dem__add(a, c), u);
}

/* Only the two nearest bars of a family count, this one and the next. Beside the deck they are its last. */
DEM_INLINE double dem__nearest_bar(const dem_wall *w, int family, double across) {
    const double pitch = w->aperture + w->wire, half = family ? w->half_x : w->half_y, nearest = floor(across / pitch + 0.5);
    if (fabs(across) < half - pitch) return nearest;
    const double last = floor(half / pitch + 0.5);
    return dem__clamp(nearest, 1.0 - last, last - 1.0);
}

/* Any other is at least this far away, if none overlaps by more: the gap of the nearest, where that is less than 0. */
DEM_INLINE double dem__third_bar(const dem_wall *w, double radius, double lowest) {
    const double pitch = w->aperture + w->wire, sum = radius + 0.5 * w->wire, near = lowest < 0.0 ? sum + lowest : sum;
    return sqrt(near * near + 0.75 * pitch * pitch) - sum;
}

/* The nearest point of a frustum lies in the plane of axis and centre, on a segment. d: the centre, seen from the low end. */
static inline int dem__touch_cone(const dem_wall *w, dem_vec d, double up, double radius, double limit, dem__touch *out, double *least) {
    const dem_vec radial = dem__sub(d, dem__scale(up, w->axis[2]));
    const double rho = dem__length(radial), rise = w->high_radius - w->radius, slant = sqrt(rise * rise + w->length * w->length);
    const dem_vec outward = rho > 0.0 ? dem__scale(1.0 / rho, radial) : w->axis[0]; /* on the axis a ring touches: any of it */
    const double along = dem__clamp(((rho - w->radius) * rise + up * w->length) / (slant * slant), 0.0, 1.0);
    const double x = rho - (w->radius + along * rise), y = up - along * w->length;
    double distance = sqrt(x * x + y * y), nx = w->length / slant, ny = -rise / slant;
    const int on_rim = !(along > 0.0 && along < 1.0);
    if (!on_rim) { /* from the side's own normal, which does not lose its figures near the surface */
        const double side = (rho - w->radius) * nx + up * ny;
        distance = fabs(side);
        if (side < 0.0) nx = -nx, ny = -ny;
    } else if (distance > 0.0) nx = x / distance, ny = y / distance;
    *least = out[0].gap = distance - radius;
    if (!(*least < limit)) return 0;
    out[0].normal = dem__add(dem__scale(nx, outward), dem__scale(ny, w->axis[2]));
    /* half way up: one kind of contact wherever it begins; balls wider than the ring lie on a rim */
    out[0].curvature = on_rim ? 0.0 : (nx < 0.0 ? -1.0 : 1.0) * w->length / (slant * (w->radius + w->high_radius));
    return 1;
}

/* A mesh's triangles in the wall's own frame, in the order of the leaves of a tree of boxes. Its nodes stand in the order of a walk that
   takes the first child first; `skip` is where the walk goes on without a node's children. */
typedef struct dem__node {
    double low[3], high[3];
    int32_t skip, first, count; /* count: triangles of a leaf, else 0 */
} dem__node;
typedef struct dem__tree {
    size_t bytes;
    int32_t vertices, triangles, nodes;
    dem_vec *vertex, *normal;
    int32_t *corner; /* [triangles][3] */
    dem__node *node;
} dem__tree;
enum { DEM__LEAF = 4 };

/* From the plane of a triangle to p, the same for all faces of a plane. */
DEM_INLINE dem_vec dem__above_face(const dem__tree *t, int32_t k, dem_vec p, double *distance) {
    const double up = dem__dot(dem__sub(p, t->vertex[t->corner[3 * k]]), t->normal[k]);
    *distance = fabs(up);
    return dem__scale(up, t->normal[k]);
}

/* From the nearest point of a triangle to p (Ericson 2005, Real-Time Collision Detection, 5.1.5), its length, and whether it is inside. */
static inline dem_vec dem__from_triangle(const dem__tree *t, int32_t k, dem_vec p, double *distance, int *inside) {
    const dem_vec a = t->vertex[t->corner[3 * k]], b = t->vertex[t->corner[3 * k + 1]], c = t->vertex[t->corner[3 * k + 2]];
    const dem_vec ab = dem__sub(b, a), ac = dem__sub(c, a), ap = dem__sub(p, a), bp = dem__sub(p, b), cp = dem__sub(p, c);
    const double a1 = dem__dot(ab, ap), a2 = dem__dot(ac, ap), b1 = dem__dot(ab, bp), b2 = dem__dot(ac, bp), c1 = dem__dot(ab, cp),
                 c2 = dem__dot(ac, cp);
    const double to_ab = a1 * b2 - b1 * a2, to_ac = c1 * a2 - a1 * c2, to_bc = b1 * c2 - c1 * b2;
    dem_vec v;
    *inside = 0;
    if (a1 <= 0.0 && a2 <= 0.0) v = ap;
    else if (b1 >= 0.0 && b2 <= b1) v = bp;
    else if (c2 >= 0.0 && c1 <= c2) v = cp;
    else if (to_ab <= 0.0 && a1 >= 0.0 && b1 <= 0.0) v = dem__sub(ap, dem__scale(a1 / (a1 - b1), ab));
    else if (to_ac <= 0.0 && a2 >= 0.0 && c2 <= 0.0) v = dem__sub(ap, dem__scale(a2 / (a2 - c2), ac));
    else if (to_bc <= 0.0 && b2 >= b1 && c1 >= c2) v = dem__sub(bp, dem__scale((b2 - b1) / ((b2 - b1) + (c1 - c2)), dem__sub(c, b)));
    else {
        *inside = 1;
        return dem__above_face(t, k, p, distance);
    }
    *distance = dem__length(v);
    return v;
}

DEM_INLINE int dem__is_far(const dem__node *b, dem_vec p, double reach) {
    const double x = p.x - dem__clamp(p.x, b->low[0], b->high[0]), y = p.y - dem__clamp(p.y, b->low[1], b->high[1]),
                 z = p.z - dem__clamp(p.z, b->low[2], b->high[2]);
    return !(x * x + y * y + z * z < reach * reach);
}

/* One surface is touched once: a place is in the shadow of a nearer one if their normals agree to 26 degrees, or if it does not rise over
   the nearer one's tangent plane, as edges and corners of a face that is touched do not. */
DEM_INLINE int dem__is_shadowed(const dem__touch *far_one, const dem__touch *near_one, double radius) {
    const double flat = (1.0 - 1e-9) * (radius + near_one->gap) / (radius + far_one->gap);
    return dem__dot(far_one->normal, near_one->normal) > (flat < DEM__SMOOTH ? flat : DEM__SMOOTH);
}

static inline void dem__meet_triangle(const dem__tree *t, int32_t k, dem_vec p, double radius, dem__touch *touch) {
    double distance;
    int inside;
    const dem_vec v = dem__from_triangle(t, k, p, &distance, &inside);
    touch->gap = distance - radius;
    touch->normal = distance > 0.0 ? dem__scale(1.0 / distance, v) : t->normal[k];
    touch->curvature = 0.0;
    touch->face = inside ? k : -1;
}

DEM_INLINE dem_vec dem__to_frame(const dem_wall *w, dem_vec d) {
    return dem_vec3(dem__dot(d, w->axis[0]), dem__dot(d, w->axis[1]), dem__dot(d, w->axis[2]));
}
DEM_INLINE dem_vec dem__from_frame(const dem_wall *w, dem_vec v) {
    return dem__add(dem__add(dem__scale(v.x, w->axis[0]), dem__scale(v.y, w->axis[1])), dem__scale(v.z, w->axis[2]));
}

/* The nearest place of a mesh, if its gap is below limit; and with a gap below deep, the others that are none's shadow: the nearest
   DEM__TOUCHES, nearest first. */
static inline int dem__touch_mesh(const dem_wall *w, dem_vec d, double radius, double deep, double limit, dem__touch *out, double *least) {
    const dem__tree *t = w->tree;
    const dem_vec p = dem__to_frame(w, d);
    dem__touch here;
    int n = 0;
    *least = limit;
    for (int32_t b = 0; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, p, radius + *least)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) {
            dem__meet_triangle(t, k, p, radius, &here);
            if (here.gap < *least) *least = here.gap, out[0] = here, n = 1;
        }
    }
    for (int32_t b = *least < deep ? 0 : t->nodes; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, p, radius + deep)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) {
            int at = 0, kept;
            dem__meet_triangle(t, k, p, radius, &here);
            if (!(here.gap < deep)) continue;
            while (at < n && out[at].gap <= here.gap && !dem__is_shadowed(&here, &out[at], radius)) at++;
            if (at == DEM__TOUCHES || (at < n && out[at].gap <= here.gap)) continue;
            kept = at;
            for (int q = at; q < n; q++) { /* it shadows others itself */
                if (!dem__is_shadowed(&out[q], &here, radius)) out[kept++] = out[q];
            }
            n = kept < DEM__TOUCHES ? kept + 1 : DEM__TOUCHES;
            for (int q = n - 1; q > at; q--) out[q] = out[q - 1];
            out[at] = here;
        }
    }
    for (int q = 0; q < n; q++) {
        out[q].normal = dem__from_frame(w, out[q].normal);
        out[q].element = q;
    }
    return n;
}

/* How far a projection q into the plane of triangle k is inside its edges. */
static inline double dem__inside_edges(const dem__tree *t, int32_t k, dem_vec q) {
    double least = HUGE_VAL;
    for (int e = 0; e < 3; e++) {
        const dem_vec u = t->vertex[t->corner[3 * k + e]], v = t->vertex[t->corner[3 * k + (e + 1) % 3]], along = dem__sub(v, u);
        const double in = dem__dot(dem__sub(q, u), dem__cross(t->normal[k], along)) / dem__length(along);
        least = in < least ? in : least;
    }
    return least;
}

/* The footing of a sphere whose one touch is on a face. A triangle that rises above that plane may be touched, or become the nearest: from
   half its gap on; one that does not is in the face's shadow, and is nearer only where the centre leaves the face for it. */
static inline dem__footing dem__find_footing(const dem_wall *w, dem_vec d, double radius, const dem__touch *touch) {
    const dem__tree *t = w->tree;
    const int32_t face = touch->face;
    dem__footing f;
    double height;
    f.at = dem__to_frame(w, d), f.slack = 0.0, f.face = face;
    if (face < 0 || !(touch->gap <= 0.0)) return f;
    const dem_vec up = dem__above_face(t, face, f.at, &height), a = t->vertex[t->corner[3 * face]];
    const double inside = dem__inside_edges(t, face, dem__sub(f.at, up));
    double slack = 0.25 * radius < inside ? 0.25 * radius : inside;
    if (!(slack > 0.0 && height > 0.1 * radius)) return f;
    const dem_vec out = dem__scale(1.0 / height, up);
    for (int32_t b = 0; b < t->nodes;) {
        const dem__node *node = &t->node[b];
        if (dem__is_far(node, f.at, radius + 2.0 * slack)) {
            b = node->skip;
            continue;
        }
        b++;
        for (int32_t k = node->first; k < node->first + node->count; k++) {
            double distance, rise = 0.0;
            int inner;
            if (k == face) continue;
            dem__from_triangle(t, k, f.at, &distance, &inner);
            for (int c = 0; c < 3; c++) {
                const double above = dem__dot(dem__sub(t->vertex[t->corner[3 * k + c]], a), out);
                rise = above > rise ? above : rise;
            }
            const double aside = distance * distance - height * height, /* the shadow's tolerance is 1e-9 */
                reach = rise > 5e-10 * height ? 0.5 * (distance - radius) : sqrt(aside > 0.0 ? aside : 0.0);
            slack = reach < slack ? reach : slack;
        }
    }
    f.slack = slack > 0.0 ? 0.999 * slack : 0.0;
    return f;
}

/* The touch of a sphere that has not left its footing; 0: search. `opens`: the most that a contact opens in a step. */
DEM_INLINE int dem__keeps_footing(const dem_wall *w, const dem__footing *f, dem_vec d, double radius, double opens, dem__touch *out) {
    const dem_vec p = dem__to_frame(w, d), moved = dem__sub(p, f->at);
    double distance;
    if (!(f->slack > opens && dem__dot(moved, moved) < f->slack * f->slack)) return 0;
    const dem_vec v = dem__above_face(w->tree, f->face, p, &distance);
    out->gap = distance - radius;
    out->normal = dem__from_frame(w, dem__scale(1.0 / distance, v));
    return 1;
}

/* All places where a sphere's gap to a wall is below limit (at most DEM__TOUCHES; of a mesh the nearest, and those that overlap); *least
   becomes a lower bound of the gap. */
static inline int dem__touch_wall(const dem_wall *w, dem_vec centre, double radius, double limit, dem__touch *out, double *least) {
    dem_vec d = dem__sub(centre, w->position);
    double up = dem__dot(d, w->axis[2]);
    int n = 0;
    out[0].element = 0;
    out[0].curvature = 0.0;
    if (w->kind == DEM_PLANE || w->kind == DEM_EXIT) {
        out[0].gap = up - (w->kind == DEM_PLANE ? radius : 0.0);
        out[0].normal = w->axis[2];
        *least = out[0].gap;
        return out[0].gap < limit;
    }
    if (w->kind == DEM_CYLINDER) {
        dem_vec radial = dem__sub(d, dem__scale(up, w->axis[2]));
        double distance = dem__length(radial);
        out[0].gap = (w->inside ? w->radius - distance : distance - w->radius) - radius;
        *least = out[0].gap;
        if (!(out[0].gap < limit) || !(distance > 0.0)) return 0;
        out[0].normal = dem__scale((w->inside ? -1.0 : 1.0) / distance, radial);
        out[0].curvature = (w->inside ? -0.5 : 0.5) / w->radius;
        return 1;
    }
    if (w->kind == DEM_SPHERE) {
        const double distance = dem__length(d);
        out[0].gap = (w->inside ? w->radius - distance : distance - w->radius) - radius;
        *least = out[0].gap;
        if (!(out[0].gap < limit) || !(distance > 0.0)) return 0;
        out[0].normal = dem__scale((w->inside ? -1.0 : 1.0) / distance, d);
        out[0].curvature = (w->inside ? -1.0 : 1.0) / w->radius;
        return 1;
    }
    if (w->kind == DEM_CONE) return dem__touch_cone(w, d, up, radius, limit, out, least);
    if (w->kind == DEM_MESH) return dem__touch_mesh(w, d, radius, limit < 0.0 ? limit : 0.0, limit, out, least);
    *least = fabs(up) - radius - 0.5 * w->wire;
    if (!(*least < limit)) return 0;
    double bound = HUGE_VAL;
    for (int family = 0; family < 2; family++) {
        const double along = dem__dot(d, w->axis[family]), across = dem__dot(d, w->axis[1 - family]);
        const double nearest = dem__nearest_bar(w, family, across);
        if (!(fabs(nearest) < 1e6)) continue;
        for (int side = 0; side < 2; side++) {
            if (!dem__touch_bar(w, family, nearest + side, along, across, up, radius, &out[n])) continue;
            bound = out[n].gap < bound ? out[n].gap : bound;
            if (!(out[n].gap < limit)) continue;
            out[n].normal = dem__from_bar(w, family, out[n].normal);
            n++;
        }
    }
    const double third = dem__third_bar(w, radius, bound);
    bound = third < bound ? third : bound;
    *least = bound > *least ? bound : *least;
    return n;
}

/* The one place that an element of a wall touches, at any gap. */
static inline void dem__touch_element(const dem_wall *w, dem_vec centre, double radius, int32_t element, dem__touch *out) {
    double least;
    if (w->kind == DEM_SCREEN) {
        const dem_vec d = dem__sub(centre, w->position);
        const int family = (int)((uint32_t)element & 1u);
        const double index = (double)((element - family) / 2);
        out->gap = HUGE_VAL, out->curvature = 0.0, out->normal = w->axis[2];
        if (dem__touch_bar(w, family, index, dem__dot(d, w->axis[family]), dem__dot(d, w->axis[1 - family]), dem__dot(d, w->axis[2]),
                           radius, out))
            out->normal = dem__from_bar(w, family, out->normal);
        return;
    }
    dem__touch touch[DEM__TOUCHES]; /* a mesh may have as many */
    touch[0].gap = HUGE_VAL, touch[0].normal = w->axis[2];
    dem__touch_wall(w, centre, radius, HUGE_VAL, touch, &least);
    *out = touch[0];
}

/* From the axis or centre of a wall that is round at an element to a sphere's centre, and how far from there the surface is. Returns 1 if
   the sphere is outside, -1 if inside, 0 if the place is not round or has no normal. */
static inline double dem__reach_round(const dem_wall *w, dem_vec centre, int32_t element, dem_vec *from, double *inner) {
    const dem_vec d = dem__sub(centre, w->position);
    if (w->kind == DEM_SCREEN) {
        const int family = (int)((uint32_t)element & 1u);
        const double along = dem__dot(d, w->axis[family]), across = dem__dot(d, w->axis[1 - family]), up = dem__dot(d, w->axis[2]);
        *inner = dem__reach_bar(w, family, (double)((element - family) / 2), along, across, up, from);
        *from = dem__from_bar(w, family, *from);
        return *inner >= 0.0 && dem__dot(*from, *from) > 0.0 ? 1.0 : 0.0;
    }
    if (w->kind != DEM_CYLINDER && w->kind != DEM_SPHERE) return 0.0;
    *from = w->kind == DEM_SPHERE ? d : dem__plus(d, -dem__dot(d, w->axis[2]), w->axis[2]);
    *inner = w->radius;
    return !(dem__dot(*from, *from) > 0.0) ? 0.0 : w->inside ? -1.0 : 1.0;
}

/* How the normal turns at a cone, which is a ring's at a rim. */
static inline dem_vec dem__normal_rate_of_cone(const dem_wall *w, dem_vec d, double radius, dem_vec n, dem_vec u) {
    const dem_vec radial = dem__plus(d, -dem__dot(d, w->axis[2]), w->axis[2]);
    dem__touch touch;
    double least;
    const double from_axis = dem__length(radial);
    if (!dem__touch_cone(w, d, dem__dot(d, w->axis[2]), radius, HUGE_VAL, &touch, &least) || !(from_axis > 0.0))
        return dem_vec3(0.0, 0.0, 0.0);
    const dem_vec outward = dem__scale(1.0 / from_axis, radial);
    const dem_vec round = dem__cross(w->axis[2], outward);
    const double about = dem__dot(u, round);
    dem_vec rate = dem__scale(dem__dot(n, outward) * about / from_axis, round);
    if (touch.curvature != 0.0) return rate;
    const dem_vec up = dem__sub(u, dem__add(dem__scale(dem__dot(u, n), n), dem__scale(about, round)));
    return dem__plus(rate, 1.0 / (radius + touch.gap), up);
}

/* How the normal n at a place of a wall turns [1/s] while a sphere moves at u in the wall's own frame. inverse: 1 / distance from the axis of
   a round one, with the sign of the side. */
static inline dem_vec dem__normal_rate(const dem_wall *w, dem_vec centre, double radius, int32_t element, dem_vec n, double inverse,
                                       dem_vec u) {
    const dem_vec side = dem__sub(u, dem__scale(dem__dot(u, n), n));
    if (w->kind == DEM_SPHERE) return dem__scale(inverse, side);
    if (w->kind == DEM_CYLINDER) return dem__scale(inverse, dem__plus(side, -dem__dot(side, w->axis[2]), w->axis[2]));
    if (w->kind == DEM_CONE) return dem__normal_rate_of_cone(w, dem__sub(centre, w->position), radius, n, u);
    if (w->kind == DEM_SCREEN) {
        const dem_vec along = w->axis[(uint32_t)element & 1u];
        if (fabs(dem__dot(n, along)) > 1e-9) return dem__scale(inverse, side);              /* at a bar's end */
        if (!(fabs(dem__dot(n, w->axis[2])) < 1.0 - 1e-12) && w->profile == DEM_SEMICIRCLE && dem__dot(n, w->axis[2]) < 0.0)
            return dem_vec3(0.0, 0.0, 0.0); /* its flat side */
        return dem__scale(inverse, dem__plus(side, -dem__dot(side, along), along));
    }
    return dem_vec3(0.0, 0.0, 0.0);
}

/* Velocity and acceleration of a sliding wall's surface at a point, whose normal is n. */
DEM_INLINE dem_vec dem__surface_velocity(const dem_wall *w, dem_vec point, dem_vec n) {
    const dem_vec turning = dem__cross(dem__scale(w->spin, w->spin_axis), dem__sub(point, w->position));
    return dem__add(dem__add(w->velocity, turning), dem__sub(w->belt, dem__scale(dem__dot(w->belt, n), n)));
}
DEM_INLINE dem_vec dem__surface_acceleration(const dem_wall *w, dem_vec point) {
    const dem_vec omega = dem__scale(w->spin, w->spin_axis), arm = dem__sub(point, w->position);
    const dem_vec inward = dem__cross(omega, dem__cross(omega, arm));
    return dem__add(w->acceleration, dem__add(inward, dem__scale(w->spin_rate, dem__cross(w->spin_axis, arm))));
}
