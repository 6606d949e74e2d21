/* ------------------------------------------------------------------------------------------------- >>scene */

/* Acceleration of a particle in flight without loads [m/s2]. Bounds and the list count on its being the same for all. */
DEM_INLINE dem_vec dem__free_fall(const dem_world *w) { return w->def.gravity; }

DEM_INLINE double dem__now(const dem_world *w, ptrdiff_t i) { return (double)(w->step - w->particle[i].origin) * w->engine->run.dt; }

DEM_INLINE double dem__wrapped(double v, double low, double high) {
    if (v >= low && v < high) return v;
    const double length = high - low, x = v - length * floor((v - low) / length);
    return x < low ? low : x > high ? high : x; /* what is very far away has no place left but that */
}

/* Position on the parabola at tau after the origin step. */
DEM_INLINE dem_vec dem__at(const dem_world *w, ptrdiff_t i, double tau) {
    const dem_particle *p = &w->particle[i];
    return dem__plus(p->x, tau, dem__plus(p->v, 0.5 * tau, p->a));
}
DEM_INLINE dem_vec dem__in_box(const dem_world *w, dem_vec x) {
    const dem_def *d = &w->def;
    if (d->periodic[0]) x.x = dem__wrapped(x.x, d->low.x, d->high.x);
    if (d->periodic[1]) x.y = dem__wrapped(x.y, d->low.y, d->high.y);
    if (d->periodic[2]) x.z = dem__wrapped(x.z, d->low.z, d->high.z);
    return x;
}
DEM_INLINE dem_vec dem__velocity_at(const dem_world *w, ptrdiff_t i, double tau) {
    return dem__plus(w->particle[i].v, tau, w->particle[i].a);
}

DEM_INLINE dem_vec dem__spin_at(const dem_world *w, ptrdiff_t i, double tau) {
    return dem__plus(w->particle[i].spin, tau, w->spin_rate[i]);
}

/* Makes the present step the origin: the parabola's state becomes the stored one. */
static inline void dem__set_origin(dem_world *w, ptrdiff_t i) {
    const double tau = dem__now(w, i);
    dem_particle *p = &w->particle[i];
    p->x = dem__at(w, i, tau), p->v = dem__velocity_at(w, i, tau), p->spin = dem__spin_at(w, i, tau);
    w->particle[i].origin = w->step;
}

/* Puts a stored position back into the periodic box. Where gravity has a part along the box it regains potential energy. */
DEM_INLINE void dem__wrap(dem_world *w, ptrdiff_t i) {
    dem_particle *p = &w->particle[i];
    const dem_vec x = dem__in_box(w, p->x);
    if (w->engine->ledger.on) dem__book_wrap(w, -p->mass * dem__dot(dem__free_fall(w), dem__sub(x, p->x)));
    p->x = x;
}

DEM_INLINE double dem__inertia(const dem_world *w, ptrdiff_t i) {
    return 0.4 * w->particle[i].mass * w->particle[i].radius * w->particle[i].radius;
}

DEM_INLINE double dem__kinetic(const dem_world *w, ptrdiff_t i) {
    dem_vec v = dem__velocity_at(w, i, dem__now(w, i));
    return 0.5 * w->particle[i].mass * dem__dot(v, v);
}
DEM_INLINE double dem__rotational(const dem_world *w, ptrdiff_t i) {
    const dem_vec s = dem__spin_at(w, i, dem__now(w, i));
    return 0.5 * dem__inertia(w, i) * dem__dot(s, s);
}
DEM_INLINE double dem__potential(const dem_world *w, ptrdiff_t i) {
    return -w->particle[i].mass * dem__dot(dem__free_fall(w), dem__at(w, i, dem__now(w, i)));
}

DEM_INLINE double dem__nearest(double d, double length) { return fabs(d) < 0.499999 * length ? d : d - length * floor(d / length + 0.5); }

DEM_INLINE dem_vec dem__nearest_image(const dem_world *w, dem_vec d) {
    if (w->engine->run.has_periodic) {
        if (w->def.periodic[0]) d.x = dem__nearest(d.x, w->def.high.x - w->def.low.x);
        if (w->def.periodic[1]) d.y = dem__nearest(d.y, w->def.high.y - w->def.low.y);
        if (w->def.periodic[2]) d.z = dem__nearest(d.z, w->def.high.z - w->def.low.z);
    }
    return d;
}

/* Steps between two evaluations of the links: also of a loaded world that has not got their law again. */
DEM_INLINE int dem__link_stride(const dem_world *w) {
    const double n = floor(w->engine->links.interval / w->engine->run.dt);
    return n < 1.0 ? 1 : n > 1000.0 ? 1000 : (int)n;
}

/* Work of the present link forces on particle i since they were evaluated. */
static inline double dem__link_work(const dem_world *w, ptrdiff_t i) {
    const dem__bodies *bodies = &w->engine->bodies;
    const dem__links *links = &w->engine->links;
    if (!links->is_loaded[i]) return 0.0;
    const double tau = dem__now(w, i), turned = 0.5 * w->engine->run.dt * (double)((w->step - 1) % dem__link_stride(w) + 1);
    const dem_vec way = dem__nearest_image(w, dem__sub(dem__at(w, i, tau), dem__first(links->evaluated_at[i])));
    const dem_vec force = dem__sub(dem__first(bodies->load[i]), dem__first(bodies->external[i]));
    const dem_vec torque = dem__sub(dem__second(bodies->load[i]), dem__second(bodies->external[i]));
    return dem__dot(force, way) + turned * dem__dot(torque, dem__add(dem__spin_at(w, i, tau), dem__second(links->evaluated_at[i])));
}

/* What makes accelerations of forces on particle i. */
static inline void dem__set_inverse_mass(dem_world *w, ptrdiff_t i) {
    dem__sum *sum = &w->engine->bodies.sum[i];
    sum->per_mass = 1.0 / w->particle[i].mass;
    sum->per_inertia = 2.5 * sum->per_mass / (w->particle[i].radius * w->particle[i].radius);
}

/* Acceleration without contacts. */
static inline void dem__free_acceleration(dem_world *w, ptrdiff_t i) {
    dem__bodies *bodies = &w->engine->bodies;
    const dem__sum *sum = &bodies->sum[i];
    w->particle[i].a = dem__plus(dem__free_fall(w), sum->per_mass, dem__first(bodies->load[i]));
    w->spin_rate[i] = dem__scale(sum->per_inertia, dem__second(bodies->load[i]));
}

DEM_INLINE double dem__sphere_mass(const dem_world *w, int material, double radius) {
    const double d = 2.0 * radius;
    return RIDDLE_PI / 6.0 * d * d * d * w->def.material[material].density;
}

/* A diameter whose mass and inertia are numbers. */
static inline int dem__is_size(const dem_world *w, int material, double d) {
    return dem__positive(d) && dem__positive(dem__sphere_mass(w, material, 0.5 * d) * d * d);
}

DEM_API dem_status dem_add_spheres(dem_world *world, ptrdiff_t n, const double *centres, const double *diameters, int material, int group) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (!w || !w->def.allocator.fn || n < 0 || (n > 0 && (!centres || !diameters)) || material < 0 || material >= w->def.materials)
        return DEM_BAD_ARGUMENT;
    if (n > INT32_MAX / 4 - w->count) return DEM_TOO_MANY;
    for (ptrdiff_t k = 0; k < n; k++) {
        if (!dem__is_size(w, material, diameters[k]) || !dem__finite(centres[3 * k]) || !dem__finite(centres[3 * k + 1]) ||
            !dem__finite(centres[3 * k + 2]))
            return DEM_BAD_ARGUMENT;
    }
    if (w->count + n + 1 > w->engine->bodies.capacity) {
        dem__array list[DEM__ARRAYS_MAX];
        int arrays = dem__particle_arrays(w, list);
        if (!dem__grow_group(w, list, arrays, &w->engine->bodies.block, &w->engine->bodies.bytes, &w->engine->bodies.capacity,
                             w->count + n + 1))
            return DEM_OUT_OF_MEMORY;
    }
    for (ptrdiff_t k = 0; k < n; k++) {
        ptrdiff_t i = w->count++;
        const double d = diameters[k];
        dem_particle *p = &w->particle[i];
        p->x = dem__in_box(w, dem_vec3(centres[3 * k], centres[3 * k + 1], centres[3 * k + 2]));
        p->v = dem_vec3(0.0, 0.0, 0.0);
        p->spin = dem_vec3(0.0, 0.0, 0.0);
        for (int a = 0; a < 6; a++) w->engine->bodies.load[i][a] = w->engine->bodies.external[i][a] = 0.0;
        p->radius = 0.5 * d;
        p->mass = RIDDLE_PI / 6.0 * d * d * d * w->def.material[material].density;
        dem__set_inverse_mass(w, i);
        w->particle[i].origin = w->step;
        w->id[i] = w->engine->bodies.next_id++;
        w->material[i] = material;
        w->group[i] = group;
        w->alive[i] = 1;
        w->touching[i] = w->engine->bodies.activity[i] = 0;
        w->engine->walls.first_contact[i] = w->engine->links.first_link[i] = -1;
        w->engine->links.is_loaded[i] = 0;
        memset(&w->engine->bodies.bound[i], 0, sizeof w->engine->bodies.bound[i]);
        w->engine->bodies.impact[i] = dem_vec3(0.0, 0.0, 0.0);
        dem__free_acceleration(w, i);
        dem__book_added(w, dem__potential(w, i));
    }
    if (n > 0) w->engine->run.needs_forces = w->engine->run.needs_lists = 1;
    return DEM_OK;
}

static inline void dem__set_stride(dem_world *w) {
    if (w->engine->links.law) w->engine->links.stride = dem__link_stride(w);
}

DEM_API dem_status dem_set_time_step(dem_world *world, double dt) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (!w || !w->def.allocator.fn || !(dt > 0.0 && dt < 1e6)) return DEM_BAD_ARGUMENT;
    for (ptrdiff_t i = 0; i < w->count; i++) dem__set_origin(w, i);
    w->engine->run.start_time = w->time;
    w->engine->run.start_step = w->step;
    w->def.dt = w->engine->run.dt = dt;
    dem__set_stride(w);
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    return DEM_OK;
}

DEM_API dem_status dem_set_gravity(dem_world *world, dem_vec gravity) {
    dem_world *w = world;
    if (dem__is_running(w)) return DEM_BUSY;
    if (!w || !w->def.allocator.fn || !dem__moderate_vec(gravity)) return DEM_BAD_ARGUMENT;
    const dem_vec change = dem__sub(gravity, w->def.gravity);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        dem__set_origin(w, i);
        w->particle[i].a = dem__add(w->particle[i].a, change);
    }
    if (w->engine->ledger.on) {
        for (ptrdiff_t i = 0; i < w->count; i++) {
            const double raised = w->alive[i] ? -w->particle[i].mass * dem__dot(change, w->particle[i].x) : 0.0;
            w->engine->ledger.sums.added += raised, w->engine->ledger.sums.added_potential += raised;
        }
    }
    w->def.gravity = gravity;
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (w->alive[i] && !w->touching[i]) dem__free_acceleration(w, i);
    }
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    return DEM_OK;
}

DEM_API dem_status dem_set_pair(dem_world *world, int a, int b, const dem_pair_def *pair) {
    dem_world *w = world;
    if (dem__is_running(w)) return DEM_BUSY;
    if (!w || !w->def.allocator.fn || !pair || a < 0 || b < 0 || a >= w->def.materials || b >= w->def.materials || dem__bad_pair(pair))
        return DEM_BAD_ARGUMENT;
    *dem_pair(&w->def, a, b) = *pair;
    w->engine->run.needs_lists = w->engine->run.needs_forces = 1;
    return DEM_OK;
}

DEM_INLINE int dem__is_loaded(const dem_world *w, ptrdiff_t i) {
    const double *e = w->engine->bodies.external[i];
    return e[0] != 0.0 || e[1] != 0.0 || e[2] != 0.0 || e[3] != 0.0 || e[4] != 0.0 || e[5] != 0.0;
}

static inline int dem__is_present(const dem_world *w, ptrdiff_t i) { return w && i >= 0 && i < w->count && w->alive[i]; }

DEM_API dem_status dem_set_motion(dem_world *world, ptrdiff_t i, dem_vec velocity, dem_vec spin) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (!dem__is_present(w, i) || !dem__moderate_vec(velocity) || !dem__moderate_vec(spin)) return DEM_BAD_ARGUMENT;
    dem__book_motion(w, -(dem__kinetic(w, i) + dem__rotational(w, i)));
    dem__set_origin(w, i);
    w->particle[i].v = dem__flushed_vec(velocity);
    w->particle[i].spin = dem__flushed_vec(spin);
    dem__book_motion(w, dem__kinetic(w, i) + dem__rotational(w, i));
    w->engine->run.needs_lists = 1;
    return DEM_OK;
}

DEM_API dem_status dem_set_load(dem_world *world, ptrdiff_t i, dem_vec force, dem_vec torque) {
    if (dem__is_running(world)) return DEM_BUSY;
    dem_world *w = world;
    if (!dem__is_present(w, i) || !dem__finite_vec(force) || !dem__finite_vec(torque)) return DEM_BAD_ARGUMENT;
    dem__set_origin(w, i);
    double *load = w->engine->bodies.load[i], *external = w->engine->bodies.external[i];
    dem_vec *const rate[] = {&w->particle[i].a, &w->spin_rate[i]};
    const double wanted[] = {force.x, force.y, force.z, torque.x, torque.y, torque.z};
    for (int a = 0; a < 6; a++) {
        const double change = wanted[a] - external[a];
        *dem_axis_of(rate[a / 3], a % 3) += change / (a < 3 ? w->particle[i].mass : dem__inertia(w, i));
        load[a] = !w->engine->links.is_loaded[i] ? wanted[a] : load[a] + change;
        external[a] = wanted[a];
    }
    if (!w->touching[i]) dem__free_acceleration(w, i);
    if (!w->engine->bodies.activity[i]) { /* a loaded particle is no free flight: it takes steps */
        w->engine->bodies.activity[i] = 1;
        w->engine->bodies.active[w->engine->bodies.active_count++] = (int32_t)i;
    }
    w->engine->bodies.loads_on = w->engine->run.needs_lists = 1;
    return DEM_OK;
}
