/* Measuring: regions, stress, fields, histograms. Reads a const world; writes the caller's arrays. */
#pragma once
#include "branches.h"
#include "within.h"

/* Lists the displacements of the images of the periodic box: the box itself first, then one on either side along each
   periodic axis. Returns how many. */
static inline int dem__images(const dem_world *w, dem_vec shift[27]) {
    int n = 1;
    shift[0] = dem_vec3(0.0, 0.0, 0.0);
    for (int a = 0; a < 3; a++) {
        if (!w->def.periodic[a]) continue;
        const double length = dem_axis(w->def.high, a) - dem_axis(w->def.low, a);
        for (int k = 0; k < 2 * n; k++) {
            shift[n + k] = shift[k / 2];
            *dem_axis_of(&shift[n + k], a) += k % 2 ? length : -length;
        }
        n *= 3;
    }
    return n;
}

/* Finds where particle i is counted, and its velocity there. A rigid body counts once, at its centre of mass. Returns 0
   for its other particles. */
static inline int dem__counts(const dem_world *w, ptrdiff_t i, dem_vec *at, dem_vec *v) {
    if (!dem__leads(w, i)) return 0;
    *at = dem__centre_now(w, i), *v = dem__true_drift_at(w, i, dem__now(w, i));
    return 1;
}

/* Returns the factor of a particle's volume: 1 for a sphere. The spheres of a body may overlap; they share the body's
   volume. The parts of a compound have their own. */
static inline double dem__filled(const dem_world *w, ptrdiff_t i) {
    const dem__rigid *r = dem__rigid_of(w, i);
    const double radius = w->particle[i].radius;
    double sum = 0.0;
    if (dem__is_part(w, i)) return dem__shape_of(w, i)->volume / (4.0 / 3.0 * RIDDLE_PI * radius * radius * radius);
    for (ptrdiff_t k = 0; r && k < r->pieces; k++)
        sum += dem__sphere_mass(w, w->material[i], w->particle[r->first + k].radius);
    return r ? r->mass / sum : 1.0;
}

DEM_INLINE void dem__add_stress(double (*stress)[3], double weight, dem_vec f, dem_vec l) {
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) stress[a][b] += weight * dem_axis(f, a) * dem_axis(l, b);
    }
}

/* A region that is measured. */
typedef struct dem__measured {
    const dem_region *region;
    dem_wall inside;   /* the tree of a mesh region */
    dem_vec low, high; /* the box around the region */
    dem_vec shift[27]; /* from a particle to its images in the periodic box; the first is 0 */
    int images;
    double share; /* 1 / volume [1/m3] */
} dem__measured;

/* Returns the volume of particle i at x that is in the region; for a polyhedron, over its share of the sphere around
   it. */
static inline double dem__volume_in(const dem_world *w, const dem__measured *q, ptrdiff_t i, dem_vec x) {
    const dem_convex *s = dem__shape_of(w, i);
    const double r = w->particle[i].radius;
    if (!s) return dem__ball_in(q->region, &q->inside, x, r);
    const dem_quaternion turn = dem__turn_of_polyhedron(w, i, dem__body_turn_at(w, i, dem__now(w, i)));
    return dem__polyhedron_in(q->region, &q->inside, s, x, turn) * (4.0 / 3.0 * RIDDLE_PI * r * r * r);
}

/* Adds the volume of particle i and its images in the region, as a share of the region. */
static inline void dem__add_solid(const dem_world *w, const dem__measured *q, ptrdiff_t i, dem_measure *m) {
    const dem_vec at = dem_position(w, i), low = q->low, high = q->high;
    const double r = w->particle[i].radius, filled = dem__filled(w, i) * q->share;
    for (int image = 0; image < q->images; image++) {
        const dem_vec x = dem__add(at, q->shift[image]);
        if (x.x + r >= low.x && x.x - r <= high.x && x.y + r >= low.y && x.y - r <= high.y && x.z + r >= low.z &&
            x.z - r <= high.z)
            m->solid_fraction += dem__volume_in(w, q, i, x) * filled;
    }
}

/* Returns whether v lies in a region's box along an axis. Of a point on the edge of a periodic box one image counts. */
DEM_INLINE int dem__is_between(const dem_world *w, const dem__measured *q, int a, double v) {
    const double high = dem_axis(q->high, a);
    return v >= dem_axis(q->low, a) && (w->def.periodic[a] ? v < high : v <= high);
}

/* Returns how many images of a point are in a region. */
static inline int dem__images_in(const dem_world *w, const dem__measured *q, dem_vec point) {
    int n = 0;
    for (int image = 0; image < q->images; image++) {
        const dem_vec c = dem__add(point, q->shift[image]);
        if (!(dem__is_between(w, q, 0, c.x) && dem__is_between(w, q, 1, c.y) && dem__is_between(w, q, 2, c.z)))
            continue;
        n += dem__holds(q->region, &q->inside, c);
    }
    return n;
}

/* Measures number, mass, mean velocity and coordination number, and the solid fraction. */
static inline void dem__measure_bodies(const dem_world *w, const dem__measured *q, dem_measure *m) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dem_vec centre, v;
        if (!w->alive[i]) continue;
        dem__add_solid(w, q, i, m);
        for (int n = dem__counts(w, i, &centre, &v) ? dem__images_in(w, q, centre) : 0; n > 0; n--) {
            m->count++;
            m->mass += w->particle[i].mass;
            m->coordination += w->touching[i];
            m->velocity = dem__add(m->velocity, dem__scale(w->particle[i].mass, v));
        }
    }
    m->velocity = dem__scale(m->count > 0 ? 1.0 / m->mass : 0.0, m->velocity);
    if (m->count > 0) m->coordination /= (double)m->count;
}

/* Measures granular temperature and kinetic stress, which are relative to the mean velocity. */
static inline void dem__measure_fluctuations(const dem_world *w, const dem__measured *q, dem_measure *m) {
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dem_vec centre, v;
        if (!w->alive[i] || !dem__counts(w, i, &centre, &v)) continue;
        const dem_vec u = dem__sub(v, m->velocity);
        for (int n = dem__images_in(w, q, centre); n > 0; n--) {
            m->granular_temperature += w->particle[i].mass * dem__dot(u, u);
            dem__add_stress(m->kinetic_stress, w->particle[i].mass * q->share, u, u);
        }
    }
    m->granular_temperature *= (m->count > 0 ? 1.0 / m->mass : 0.0) / 3.0;
}

/* Measures the stress that forces of contacts and links cause. */
static inline void dem__measure_contacts(const dem_world *w, const dem__measured *q, dem_measure *m) {
    for (ptrdiff_t k = 0; k < dem__forces(w); k++) {
        dem_vec from, to, force;
        if (!dem__branch(w, k, &from, &to, &force)) continue;
        for (int image = 0; image < q->images; image++) {
            const double part =
                dem__share_in(q->region, &q->inside, dem__add(from, q->shift[image]), dem__add(to, q->shift[image]));
            if (part > 0.0) dem__add_stress(m->contact_stress, part * q->share, force, dem__sub(to, from));
        }
    }
}

DEM_API dem_status dem_measure_region(const dem_world *world, const dem_region *region, dem_measure *measure) {
    const dem_world *w = world;
    dem_measure m;
    dem__measured q;
    if (!w || !w->def.allocator.fn || !measure || !dem__is_region(region)) return DEM_BAD_ARGUMENT;
    memset(&q, 0, sizeof q);
    const dem_status status = dem__make_inside(&q.inside, w, region);
    if (status != DEM_OK) return status;
    const double volume = dem_region_volume(region);
    q.region = region, q.share = volume > 0.0 ? 1.0 / volume : (double)NAN;
    q.images = dem__images(w, q.shift);
    dem__tree_bounds(region, &q.low, &q.high);
    memset(&m, 0, sizeof m);
    dem__measure_bodies(w, &q, &m);
    dem__measure_fluctuations(w, &q, &m);
    dem__measure_contacts(w, &q, &m);
    if (q.inside.tree) w->def.allocator.fn(w->def.allocator.user, q.inside.tree, q.inside.tree->bytes, 0);
    *measure = m;
    return DEM_OK;
}

static inline int dem__are_cells(const dem_cells *c) {
    double number = 1.0;
    if (!c || !dem__finite_vec(c->low) || !dem__finite_vec(c->high)) return 0;
    for (int a = 0; a < 3; a++) {
        if (c->n[a] < 1 || c->n[a] > 100000 || !(dem_axis(c->high, a) > dem_axis(c->low, a)) ||
            !dem__not_negative(c->width[a]))
            return 0;
        number *= c->n[a];
    }
    return number < 1073741824.0;
}

/* Returns the integral of the coarse-graining kernel up to u. */
DEM_INLINE double dem__up_to(double u) {
    u = dem__clamp(u, -1.0, 1.0);
    return 0.5 + 0.0625 * u * (15.0 - u * u * (10.0 - 3.0 * u * u));
}

/* Finds the cells along an axis in which a point at v counts, from first to last. Returns 0 if there are none. */
static inline int dem__cells_of(const dem_cells *c, int a, double v, int *first, int *last) {
    const double low = dem_axis(c->low, a), high = dem_axis(c->high, a), inverse = c->n[a] / (high - low),
                 reach = c->width[a];
    if (!(v + reach >= low && v - reach <= high)) return 0;
    const double from = floor((v - reach - low) * inverse), to = floor((v + reach - low) * inverse),
                 most = (double)(c->n[a] - 1);
    *first = from > 0.0 ? (int)(from < most ? from : most) : 0,
    *last = to > 0.0 ? (int)(to < most ? to : most) : 0; /* true for NaN, too */
    return 1;
}

/* Returns whether a point at v is at the end of the cells along a periodic axis. Its image at their start counts. */
DEM_INLINE int dem__is_next_image(const dem_world *w, const dem_cells *c, int a, double v) {
    return w->def.periodic[a] && c->width[a] == 0.0 && v >= dem_axis(c->high, a);
}

/* Returns the share of a point at v that counts in cell k of an axis. */
DEM_INLINE double dem__share_of(const dem_cells *c, int a, int k, double v) {
    if (c->width[a] == 0.0) return 1.0;
    const double low = dem_axis(c->low, a), size = (dem_axis(c->high, a) - low) / c->n[a], at = low + k * size - v,
                 inverse = 1.0 / c->width[a];
    return dem__up_to((at + size) * inverse) - dem__up_to(at * inverse);
}

/* What a point adds to the cells around it. */
typedef struct dem__load {
    double mass, stress;            /* mass of a sphere [kg]; weight of a point on a branch */
    dem_vec velocity, force, along; /* velocity of a sphere; force of a branch, and the branch vector */
} dem__load;

/* Adds what a point and its images carry to the cells around them. */
static inline void dem__coarse_grain(const dem_world *w, const dem_cells *c, dem_field *field, dem_vec at,
                                     const dem__load *load) {
    dem_vec shift[27];
    const int images = dem__images(w, shift);
    for (int image = 0; image < images; image++) {
        int first[3], last[3];
        const dem_vec x = dem__add(at, shift[image]);
        if (dem__is_next_image(w, c, 0, x.x) || dem__is_next_image(w, c, 1, x.y) || dem__is_next_image(w, c, 2, x.z))
            continue;
        if (!dem__cells_of(c, 0, x.x, &first[0], &last[0]) || !dem__cells_of(c, 1, x.y, &first[1], &last[1]) ||
            !dem__cells_of(c, 2, x.z, &first[2], &last[2]))
            continue;
        for (int kz = first[2]; kz <= last[2]; kz++) {
            const double sz = dem__share_of(c, 2, kz, x.z);
            for (int ky = first[1]; ky <= last[1]; ky++) {
                const double sy = sz * dem__share_of(c, 1, ky, x.y);
                for (int kx = first[0]; kx <= last[0]; kx++) {
                    const double share = sy * dem__share_of(c, 0, kx, x.x), mass = share * load->mass;
                    dem_field *f = &field[((ptrdiff_t)kz * c->n[1] + ky) * c->n[0] + kx];
                    f->density += mass;
                    f->momentum = dem__add(f->momentum, dem__scale(mass, load->velocity));
                    if (load->mass > 0.0) dem__add_stress(f->kinetic_stress, mass, load->velocity, load->velocity);
                    else dem__add_stress(f->contact_stress, share * load->stress, load->force, load->along);
                }
            }
        }
    }
}

DEM_API dem_status dem_coarse_grain(const dem_world *world, const dem_cells *cells, dem_field *field) {
    static const double node[4] = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674, 0.96028985649753623};
    static const double weight[4] = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447,
                                     0.10122853629037626};
    const dem_world *w = world;
    const dem_cells *c = cells;
    dem__load load;
    if (!w || !w->def.allocator.fn || !field || !dem__are_cells(c)) return DEM_BAD_ARGUMENT;
    const ptrdiff_t number = (ptrdiff_t)c->n[0] * c->n[1] * c->n[2];
    const double volume = (c->high.x - c->low.x) * (c->high.y - c->low.y) * (c->high.z - c->low.z) / (double)number;
    memset(field, 0, (size_t)number * sizeof *field);
    memset(&load, 0, sizeof load);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        if (!w->alive[i]) continue;
        dem_vec at;
        load.mass = w->particle[i].mass;
        if (dem__counts(w, i, &at, &load.velocity)) dem__coarse_grain(w, c, field, at, &load);
    }
    memset(&load, 0, sizeof load);
    for (ptrdiff_t k = 0; k < dem__forces(w); k++) {
        dem_vec from, to;
        if (!dem__branch(w, k, &from, &to, &load.force)) continue;
        load.along = dem__sub(to, from);
        for (int p = 0; p < 8; p++) {
            const double at = 0.5 + (p < 4 ? -0.5 : 0.5) * node[p % 4];
            load.stress = 0.5 * weight[p % 4];
            dem__coarse_grain(w, c, field, dem__add(from, dem__scale(at, load.along)), &load);
        }
    }
    for (ptrdiff_t k = 0; k < number; k++) {
        dem_field *f = &field[k];
        if (f->density > 0.0) dem__add_stress(f->kinetic_stress, -1.0 / f->density, f->momentum, f->momentum);
        f->density /= volume;
        f->momentum = dem__scale(1.0 / volume, f->momentum);
        for (int a = 0; a < 9; a++)
            f->contact_stress[a / 3][a % 3] /= volume, f->kinetic_stress[a / 3][a % 3] /= volume;
    }
    return DEM_OK;
}

static inline double dem__quantity_of(const dem_contact_info *c, dem_quantity quantity) {
    if (quantity == DEM_CONTACT_FORCE) return dem__length(c->force);
    if (quantity == DEM_CONTACT_OVERLAP) return -c->gap;
    return dem__length(dem__plus(c->force, -dem__dot(c->force, c->normal), c->normal));
}

DEM_API ptrdiff_t dem_histogram(const dem_world *world, dem_quantity quantity, double low, double high, int bins,
                                double *count) {
    const dem_world *w = world;
    ptrdiff_t outside = 0;
    if (!w || !w->def.allocator.fn || !count || bins < 1 || !(low < high) || !dem__finite(high - low))
        return -(ptrdiff_t)DEM_BAD_ARGUMENT;
    if (quantity != DEM_CONTACT_FORCE && quantity != DEM_CONTACT_OVERLAP && quantity != DEM_CONTACT_TANGENTIAL_FORCE)
        return -(ptrdiff_t)DEM_BAD_ARGUMENT;
    for (int k = 0; k < bins; k++) count[k] = 0.0;
    for (ptrdiff_t k = 0; k < w->engine->contacts.count; k++) {
        const dem_contact_info c = dem_get_contact(w, k);
        if (!(c.gap < 0.0)) continue;
        const double value = dem__quantity_of(&c, quantity), bin = floor((value - low) / (high - low) * bins);
        if (value >= low && value <= high) count[bin < (double)bins ? (int)bin : bins - 1] += 1.0;
        else outside++;
    }
    return outside;
}

DEM_API dem_status dem_residence(const dem_world *world, const dem_region *region, ptrdiff_t n, double *entered,
                                 double *stayed) {
    const dem_world *w = world;
    if (!w || !w->def.allocator.fn || !dem__is_region(region) || n < 0 || (n > 0 && (!entered || !stayed)))
        return DEM_BAD_ARGUMENT;
    for (ptrdiff_t k = 0; k < w->passed_count; k++) {
        const dem_passed *p = &w->passed[k];
        if (p->id >= (uint64_t)n || !dem__finite(entered[p->id])) continue;
        stayed[p->id] += p->time - entered[p->id];
        entered[p->id] = (double)NAN;
    }
    for (ptrdiff_t i = 0; i < w->count; i++) {
        const uint64_t id = w->id[i];
        dem_vec at, v;
        if (!w->alive[i] || id >= (uint64_t)n || !dem__counts(w, i, &at, &v)) continue;
        const int inside = dem_region_holds(region, at), was = dem__finite(entered[id]);
        if (was && !inside) stayed[id] += w->time - entered[id];
        if (was != inside) entered[id] = inside ? w->time : (double)NAN;
    }
    return DEM_OK;
}
