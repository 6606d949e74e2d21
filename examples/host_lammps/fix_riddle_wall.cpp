#include "fix_riddle_wall.h"

#include <cstring>

#include "atom.h"
#include "domain.h"
#include "error.h"
#include "fix_riddle_liquid.h"
#include "force.h"
#include "modify.h"
#include "pair_riddle_wet.h"
#include "update.h"

using namespace LAMMPS_NS;

FixRiddleWall::FixRiddleWall(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg) {
    dem_def def = dem_default_def();
    const int solid = dem_add_material(&def, 2500.0, 5e10, 0.2);
    contact = *dem_pair(&def, solid, solid);
    angle = bridge_pair_default_def().angle_j;
    position = amplitude = cylinder_radius = cylinder_spin = 0.0;
    period = 1.0;
    axis = -2;
    for (int k = 3; k + 1 < narg; k += 2) {
        const double value = strcmp(arg[k], "plane") == 0 ? 0.0 : utils::numeric(FLERR, arg[k + 1], false, lmp);
        if (strcmp(arg[k], "stiffness") == 0) contact.stiffness = value;
        else if (strcmp(arg[k], "restitution") == 0) contact.restitution = value;
        else if (strcmp(arg[k], "friction") == 0) contact.friction = value;
        else if (strcmp(arg[k], "angle") == 0) angle = value / 180.0 * RIDDLE_PI;
        else if (strcmp(arg[k], "plane") == 0 && k + 2 < narg && strlen(arg[k + 1]) == 1 && strchr("xyz", arg[k + 1][0])) {
            axis = arg[k + 1][0] - 'x';
            position = utils::numeric(FLERR, arg[k + 2], false, lmp);
            k++;
        } else if (strcmp(arg[k], "wiggle") == 0 && k + 2 < narg && axis >= 0) {
            amplitude = value;
            period = utils::numeric(FLERR, arg[k + 2], false, lmp);
            k++;
        } else if (strcmp(arg[k], "cylinder") == 0 && k + 2 < narg) {
            axis = -1;
            cylinder_radius = value;
            cylinder_spin = utils::numeric(FLERR, arg[k + 2], false, lmp);
            k++;
        } else error->all(FLERR, std::string("fix riddle/wall: ") + arg[k] + " is not allowed here");
    }
    if (axis == -2 || !(contact.stiffness > 0.0) || !(contact.restitution > 0.0 && contact.restitution <= 1.0) ||
        !(contact.friction >= 0.0) || !(angle >= 0.0 && angle <= 1.05) || !(period > 0.0) || (axis == -1 && !(cylinder_radius > 0.0)))
        error->all(FLERR, std::string("fix riddle/wall: a plane or a cylinder with legal contact parameters is needed"));
    restart_peratom = 1;
    maxexchange = WET_STATE_SIZE;
    books = nullptr;
    pair = nullptr;
    FixRiddleWall::grow_arrays(atom->nmax);
    atom->add_callback(Atom::GROW);
    atom->add_callback(Atom::RESTART);
    for (int i = 0; i < atom->nlocal; i++) FixRiddleWall::set_arrays(i);
}

FixRiddleWall::~FixRiddleWall() {
    atom->delete_callback(id, Atom::GROW);
    atom->delete_callback(id, Atom::RESTART);
}

int FixRiddleWall::setmask() { return FixConst::POST_FORCE; }

void FixRiddleWall::init() {
    const int k = modify->find_fix_by_style("^riddle/liquid$");
    books = k < 0 ? nullptr : dynamic_cast<FixRiddleLiquid *>(modify->fix[k]);
    pair = dynamic_cast<PairRiddleWet *>(force->pair_match("riddle/wet", 1));
    if (!books || !pair) error->all(FLERR, std::string("fix riddle/wall needs pair_style riddle/wet and fix riddle/liquid"));
    kinds.resize(static_cast<size_t>(atom->ntypes + 1));
    for (int t = 1; t <= atom->ntypes; t++)
        pair->prepare(&kinds[static_cast<size_t>(t)], t, 0, contact, pair->kind(t, t)->bridge.def.angle_i, angle, BRIDGE_SPLIT_RETURN);
}

void FixRiddleWall::setup(int vflag) { post_force(vflag); }

/* Finds gap, normal and velocity against the wall's surface; false if the sphere is so far off that no bridge reaches. */
bool FixRiddleWall::meet(int i, wet_encounter *e) const {
    const double *x = atom->x[i], *v = atom->v[i], radius = atom->radius[i];
    for (int a = 0; a < 3; a++) e->normal[a] = 0.0, e->velocity[a] = v[a];
    if (axis >= 0) {
        const double phase = 2.0 * RIDDLE_PI * static_cast<double>(update->ntimestep) * update->dt / period;
        e->gap = x[axis] - (position + amplitude * (1.0 - riddle_cos(phase))) - radius;
        e->normal[axis] = 1.0;
        e->velocity[axis] -= amplitude * 2.0 * RIDDLE_PI / period * riddle_sin(phase);
    } else {
        const double distance = sqrt(x[0] * x[0] + x[1] * x[1]);
        e->gap = cylinder_radius - distance - radius;
        if (!(distance > 0.0)) return false;
        e->normal[0] = -x[0] / distance, e->normal[1] = -x[1] / distance;
        e->velocity[0] -= -cylinder_spin * x[1] / distance * cylinder_radius;
        e->velocity[1] -= cylinder_spin * x[0] / distance * cylinder_radius;
    }
    return e->gap < 0.0 || states[static_cast<size_t>(i)].liquid.volume > 0.0;
}

void FixRiddleWall::act(int i, wet_encounter *e) {
    wet_state *state = &states[static_cast<size_t>(i)];
    const wet_kind *kind = &kinds[static_cast<size_t>(atom->type[i])];
    wet_answer r;
    e->radius_i = atom->radius[i], e->radius_j = static_cast<double>(INFINITY);
    e->arm_i = e->radius_i + e->gap, e->arm_j = 0.0;
    e->mass_i = atom->rmass[i], e->mass_j = static_cast<double>(INFINITY);
    for (int a = 0; a < 3; a++) e->spin_i[a] = atom->omega[i][a], e->spin_j[a] = 0.0;
    wet_force(kind, &pair->liquid, e, state, &r);
    for (int a = 0; a < 3; a++) atom->f[i][a] += r.force[a], atom->torque[i][a] += r.torque_i[a];
    if (update->setupflag) return;
    if (r.ruptured) books->wall_rupture(i, state);
    else if (r.touching && state->asked == 0.0 && state->liquid.volume == 0.0) {
        state->asked = 1.0;
        books->wish_wall_bridge(i, kind, state);
    } else if (!r.touching && state->liquid.volume == 0.0) state->asked = 0.0;
}

void FixRiddleWall::post_force(int) {
    wet_encounter e;
    e.dt = update->setupflag ? 0.0 : update->dt;
    for (int i = 0; i < atom->nlocal; i++) {
        if (!(atom->mask[i] & groupbit)) continue;
        if (meet(i, &e)) act(i, &e);
        else memset(static_cast<void *>(&states[static_cast<size_t>(i)]), 0, sizeof(wet_state));
    }
}

void FixRiddleWall::count(double *bridges, double *volume) const {
    for (int i = 0; i < atom->nlocal; i++) {
        *bridges += states[static_cast<size_t>(i)].liquid.volume > 0.0 ? 1.0 : 0.0;
        *volume += states[static_cast<size_t>(i)].liquid.volume;
    }
}

/* ---- arrays by particle, restart ---- */

void FixRiddleWall::grow_arrays(int n) { states.resize(static_cast<size_t>(n)); }
void FixRiddleWall::copy_arrays(int i, int j, int) { states[static_cast<size_t>(j)] = states[static_cast<size_t>(i)]; }
void FixRiddleWall::set_arrays(int i) { states[static_cast<size_t>(i)] = wet_state(); }

int FixRiddleWall::pack_exchange(int i, double *buf) {
    memcpy(buf, &states[static_cast<size_t>(i)], sizeof(wet_state));
    return WET_STATE_SIZE;
}

int FixRiddleWall::unpack_exchange(int i, double *buf) {
    memcpy(static_cast<void *>(&states[static_cast<size_t>(i)]), buf, sizeof(wet_state));
    return WET_STATE_SIZE;
}

int FixRiddleWall::maxsize_restart() { return 1 + WET_STATE_SIZE; }
int FixRiddleWall::size_restart(int) { return 1 + WET_STATE_SIZE; }

int FixRiddleWall::pack_restart(int i, double *buf) {
    buf[0] = 1 + WET_STATE_SIZE;
    pack_exchange(i, buf + 1);
    return 1 + WET_STATE_SIZE;
}

void FixRiddleWall::unpack_restart(int i, int nth) {
    double *data = atom->extra[i];
    for (int k = 0; k < nth; k++) data += static_cast<int>(*data);
    unpack_exchange(i, data + 1);
}
