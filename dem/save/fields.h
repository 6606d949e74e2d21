/* What a save of a world contains, as tables of fields: one row for each field. Knows the state of every part; writes
   none. */
#pragma once
#include "../records/groups.h"

/* Lists single numbers of the world. */
static inline void dem__world_fields(dem_world *w, dem__group *g) {
    dem__engine *e = w->engine;
    dem_def *d = &w->def;
    const dem__saved_field fields[] = {
        DEM__DOUBLES("dt", d->dt, 0),
        DEM__INTEGER("step", w->step, 0),
        DEM__DOUBLES("time", w->time, 0),
        DEM__DOUBLES("start_time", e->run.start_time, 0),
        DEM__INTEGER("start_step", e->run.start_step, 0),
        DEM__DOUBLES("gravity", d->gravity, 0),
        DEM__INTEGER("materials", d->materials, 0),
        DEM__INTEGER("next_id", e->bodies.next_id, 0),
        DEM__DOUBLES("owed", w->owed, 0),
        DEM__INTEGER("threads", d->threads, 0),
        DEM__INTEGER("skip", d->skip, 0),
        DEM__INTEGER("periodic.x", d->periodic[0], 0),
        DEM__INTEGER("periodic.y", d->periodic[1], 0),
        DEM__INTEGER("periodic.z", d->periodic[2], 0),
        DEM__DOUBLES("skin", d->skin, 0),
        DEM__DOUBLES("low", d->low, 0),
        DEM__DOUBLES("high", d->high, 0),
        DEM__INTEGER("passed_total", w->passed_total, 0),
        DEM__INTEGER("particle_steps", w->particle_steps, 0),
        DEM__INTEGER("contact_steps", w->contact_steps, 0),
        DEM__INTEGER("looks", w->looks, 0),
        DEM__INTEGER("rebuilds", w->rebuilds, 0),
        DEM__INTEGER("needs_forces", e->run.needs_forces, 0),
        DEM__INTEGER("loads_on", e->bodies.loads_on, 0),
        DEM__INTEGER("contact.states", e->contacts.states, 0),
        DEM__INTEGER("contact.has_history", e->contacts.has_history, 0),
        DEM__INTEGER("contact.law", e->contacts.law, 0),
    };
    dem__set_fields(g, fields, sizeof fields, 8);
    DEM__TELL(w, world_fields, (w, g));
}

static inline void dem__material_fields(dem_material *m, dem__group *g) {
    const size_t s = sizeof *m;
    const dem__saved_field fields[] = {
        DEM__DOUBLES("material.density", m->density, s),
        DEM__DOUBLES("material.young", m->young_modulus, s),
        DEM__DOUBLES("material.poisson", m->poisson_ratio, s),
    };
    dem__set_fields(g, fields, sizeof fields, 3);
}

static inline void dem__pair_fields(dem_pair_def *p, dem__group *g) {
    const size_t s = sizeof *p;
    const dem__saved_field fields[] = {
        DEM__DOUBLES("pair.stiffness", p->stiffness, s),
        DEM__DOUBLES("pair.restitution", p->restitution, s),
        DEM__DOUBLES("pair.friction", p->friction, s),
        DEM__DOUBLES("pair.tangential_ratio", p->tangential_ratio, s),
        DEM__DOUBLES("pair.rolling", p->rolling, s),
        DEM__DOUBLES("pair.tangential_damping", p->tangential_damping, s),
        DEM__INTEGER("pair.mode", p->mode, s),
        DEM__INTEGER("pair.given", p->given, s),
    };
    dem__set_fields(g, fields, sizeof fields, 3);
}

static inline void dem__wall_fields(dem_wall *a, dem__group *g) {
    const size_t s = sizeof *a;
    dem_wall_motion *asked = &a->asked;
    const dem__saved_field fields[] = {
        DEM__INTEGER("wall.kind", a->kind, s),
        DEM__INTEGER("wall.material", a->material, s),
        DEM__INTEGER("wall.enabled", a->enabled, s),
        DEM__DOUBLES("wall.position", a->position, s),
        DEM__DOUBLES("wall.axis", a->axis, s),
        DEM__DOUBLES("wall.origin", asked->origin, s),
        DEM__DOUBLES("wall.rest_axis", asked->rest_axis, s),
        DEM__DOUBLES("wall.radius", a->radius, s),
        DEM__DOUBLES("wall.high_radius", a->high_radius, s),
        DEM__DOUBLES("wall.length", a->length, s),
        DEM__INTEGER("wall.inside", a->inside, s),
        DEM__DOUBLES("wall.aperture", a->aperture, s),
        DEM__DOUBLES("wall.wire", a->wire, s),
        DEM__INTEGER("wall.profile", a->profile, s),
        DEM__INTEGER("wall.circular", a->circular, s),
        DEM__DOUBLES("wall.half_x", a->half_x, s),
        DEM__DOUBLES("wall.half_y", a->half_y, s),
        DEM__INTEGER("wall.drive", asked->drive, s),
        DEM__DOUBLES("wall.amplitude", asked->amplitude, s),
        DEM__DOUBLES("wall.phase", asked->phase, s),
        DEM__DOUBLES("wall.frequency", asked->frequency, s),
        DEM__DOUBLES("wall.drift", asked->drift, s),
        DEM__DOUBLES("wall.spin_centre", asked->spin_centre, s),
        DEM__DOUBLES("wall.belt", asked->belt, s),
        DEM__DOUBLES("wall.belt_turn", asked->belt_turn, s),
        DEM__DOUBLES("wall.inertia", asked->inertia, s),
        DEM__DOUBLES("wall.load", asked->load, s),
        DEM__DOUBLES("wall.damping", asked->damping, s),
        DEM__DOUBLES("wall.interval", asked->interval, s),
        DEM__DOUBLES("wall.motion_start", asked->motion_start, s),
        DEM__DOUBLES("wall.velocity", a->velocity, s),
        DEM__DOUBLES("wall.acceleration", a->acceleration, s),
        DEM__DOUBLES("wall.spin_axis", a->spin_axis, s),
        DEM__DOUBLES("wall.spin", a->spin, s),
        DEM__DOUBLES("wall.spin_rate", a->spin_rate, s),
        DEM__DOUBLES("wall.coordinate", a->coordinate, s),
        DEM__DOUBLES("wall.rate", a->rate, s),
        DEM__DOUBLES("wall.rate_change", a->rate_change, s),
        DEM__DOUBLES("wall.force", a->force, s),
        DEM__DOUBLES("wall.torque", a->torque, s),
        DEM__DOUBLES("wall.impulse", a->impulse, s),
        DEM__DOUBLES("wall.angular_impulse", a->angular_impulse, s),
        DEM__DOUBLES("wall.work", a->work, s),
        DEM__INTEGER("wall.solid", a->solid, s),
        DEM__INTEGER("wall.groups", a->groups, s),
        DEM__INTEGER("wall.slides", a->slides, s),
        DEM__DOUBLES("wall.speed_bound", a->speed_bound, s),
        DEM__DOUBLES("wall.spin_bound", a->spin_bound, s),
        DEM__DOUBLES("wall.acc_bound", a->acceleration_bound, s),
        DEM__DOUBLES("wall.side_bound", a->side_bound, s),
    };
    dem__set_fields(g, fields, sizeof fields, 7);
}

/* Lists the fields of particles present. */
static inline void dem__particle_fields(dem_world *w, dem__group *g) {
    dem__bodies *bodies = &w->engine->bodies;
    dem_particle *p = w->particle;
    const size_t s = sizeof *p;
    const dem__saved_field fields[] = {
        DEM__DOUBLES("particle.x", p->x, s),
        DEM__DOUBLES("particle.v", p->v, s),
        DEM__DOUBLES("particle.a", p->a, s),
        DEM__DOUBLES("particle.radius", p->radius, s),
        DEM__DOUBLES("particle.mass", p->mass, s),
        DEM__INTEGER("particle.origin", p->origin, s),
        DEM__INTEGER("particle.id", w->id[0], sizeof *w->id),
        DEM__INTEGER("particle.material", w->material[0], sizeof *w->material),
        DEM__DOUBLES("particle.spin", p->spin, s),
        DEM__DOUBLES("particle.spin_rate", w->spin_rate[0], sizeof *w->spin_rate),
        DEM__INTEGER("particle.group", w->group[0], sizeof *w->group),
        DEM__DOUBLES("particle.load", bodies->load[0], sizeof *bodies->load),
        DEM__DOUBLES("particle.external", bodies->external[0], sizeof *bodies->external),
    };
    dem__set_fields(g, fields, sizeof fields, 8);
    DEM__TELL(w, particle_fields, (w, g));
}

static inline void dem__contact_fields(dem_world *w, dem__group *g) {
    dem__contacts *contacts = &w->engine->contacts;
    const dem__saved_field fields[] = {
        DEM__INTEGER("contact.i", contacts->i[0], sizeof *contacts->i),
        DEM__INTEGER("contact.j", contacts->j[0], sizeof *contacts->j),
        DEM__INTEGER("contact.element", contacts->element[0], sizeof *contacts->element),
        DEM__DOUBLES("contact.gap", contacts->gap[0], sizeof *contacts->gap),
        DEM__DOUBLES("contact.force", contacts->force[0], sizeof *contacts->force),
    };
    dem__set_fields(g, fields, sizeof fields, 5);
    dem__add_fields(g, "contact.state", contacts->state, contacts->states);
    g->needed = g->fields;
    const int places =
        w->engine->convex.shapes > 0 ? DEM__PLACE_BEFORE : DEM__PLACE_CACHE; /* cached faces are found again */
    if (w->engine->walls.touch_keepers) dem__add_fields(g, "contact.touch", contacts->touch, places);
    dem__add_fields(g, "contact.wrench", contacts->wrench, 9);
    DEM__TELL(w, contact_fields, (w, g));
}

static inline void dem__passed_fields(dem_passed *p, dem__group *g) {
    const size_t s = sizeof *p;
    const dem__saved_field fields[] = {
        DEM__DOUBLES("passed.time", p->time, s),
        DEM__DOUBLES("passed.diameter", p->diameter, s),
        DEM__DOUBLES("passed.position", p->position, s),
        DEM__DOUBLES("passed.velocity", p->velocity, s),
        DEM__INTEGER("passed.id", p->id, s),
        DEM__INTEGER("passed.group", p->group, s),
        DEM__INTEGER("passed.exit", p->exit, s),
    };
    dem__set_fields(g, fields, sizeof fields, 7);
}

/* A chunk, which gives the slots of its contacts. In a file a count has 8 bytes on every machine. first_rank: not
   counting the ranks of removed particles. */
typedef struct dem__saved_chunk {
    int64_t count, capacity;
    int32_t first_rank;
} dem__saved_chunk;
static inline void dem__chunk_fields(dem__saved_chunk *chunk, dem__group *g) {
    const size_t s = sizeof *chunk;
    const dem__saved_field fields[] = {
        DEM__INTEGER("chunk.count", chunk->count, s),
        DEM__INTEGER("chunk.capacity", chunk->capacity, s),
        DEM__INTEGER("chunk.first_rank", chunk->first_rank, s),
    };
    dem__set_fields(g, fields, sizeof fields, 3);
}

/* The particles in the order of their ranks. */
static inline void dem__rank_fields(dem_world *w, dem__group *g) {
    const dem__saved_field fields[] = {
        DEM__INTEGER("particle.by_rank", w->engine->bodies.by_rank[0], sizeof(int32_t)),
    };
    dem__set_fields(g, fields, sizeof fields, 1);
}

/* Lists corners and triangles of the mesh of a wall: two groups of one field each. */
static inline void dem__mesh_fields(dem_vec *vertex, int32_t *corner, int wall, dem__group *vertices,
                                    dem__group *triangles) {
    const dem__saved_field corners[] = {{"mesh00.vertex", vertex, sizeof *vertex, 3, sizeof(double)}};
    const dem__saved_field triples[] = {{"mesh00.triangle", corner, 3 * sizeof *corner, 3, sizeof *corner}};
    dem__set_fields(vertices, corners, sizeof corners, 1);
    dem__set_fields(triangles, triples, sizeof triples, 1);
    vertices->field[0].name[4] = triangles->field[0].name[4] = (char)('0' + wall / 10);
    vertices->field[0].name[5] = triangles->field[0].name[5] = (char)('0' + wall % 10);
}
