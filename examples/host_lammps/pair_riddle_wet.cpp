#include "pair_riddle_wet.h"

#include <cstring>

#include "atom.h"
#include "comm.h"
#include "domain.h"
#include "error.h"
#include "fix_riddle_liquid.h"
#include "force.h"
#include "memory.h"
#include "modify.h"
#include "neigh_list.h"
#include "neighbor.h"
#include "update.h"

using namespace LAMMPS_NS;

PairRiddleWet::PairRiddleWet(LAMMPS *lmp) : Pair(lmp) {
    single_enable = 0;
    restartinfo = 1;
    no_virial_fdotr_compute = 1;
    finitecutflag = 1;
    types = 0;
    books = nullptr;
    liquid = bridge_pair_default_def().liquid;
}

PairRiddleWet::~PairRiddleWet() {
    if (!allocated) return;
    memory->destroy(setflag);
    memory->destroy(cutsq);
}

void PairRiddleWet::allocate() {
    allocated = 1;
    types = atom->ntypes;
    const size_t n = static_cast<size_t>(types + 1);
    memory->create(setflag, types + 1, types + 1, "pair:setflag");
    memory->create(cutsq, types + 1, types + 1, "pair:cutsq");
    memset(&setflag[0][0], 0, n * n * sizeof(int));
    memset(&cutsq[0][0], 0, n * n * sizeof(double));
    coefficient.resize(n * n);
    kinds.resize(n * n);
    class_radius.resize(n);
}

void PairRiddleWet::settings(int narg, char **arg) {
    if (narg % 2) error->all(FLERR, std::string("pair_style riddle/wet: a keyword without a value"));
    for (int k = 0; k < narg; k += 2) {
        const double value = utils::numeric(FLERR, arg[k + 1], false, lmp);
        if (strcmp(arg[k], "surface_tension") == 0 && value > 0.0) liquid.surface_tension = value;
        else if (strcmp(arg[k], "viscosity") == 0 && value >= 0.0) liquid.viscosity = value;
        else error->all(FLERR, std::string("pair_style riddle/wet: ") + arg[k] + " " + arg[k + 1] + " is not allowed here");
    }
}

/* Reads the contact parameters and the contact angle [rad] of a pair of materials. */
static const char *contact_value(dem_pair_def *contact, double *angle, const char *name, double value) {
    if (strcmp(name, "stiffness") == 0 && value > 0.0) contact->stiffness = value;
    else if (strcmp(name, "restitution") == 0 && value > 0.0 && value <= 1.0) contact->restitution = value;
    else if (strcmp(name, "friction") == 0 && value >= 0.0) contact->friction = value;
    else if (strcmp(name, "angle") == 0 && value >= 0.0 && value <= 60.0) *angle = value / 180.0 * RIDDLE_PI;
    else return name;
    return nullptr;
}

void PairRiddleWet::coeff(int narg, char **arg) {
    if (!allocated) allocate();
    if (narg < 2 || narg % 2) error->all(FLERR, std::string("pair_coeff riddle/wet: expected I J and pairs of keyword and value"));
    int low_i, high_i, low_j, high_j;
    utils::bounds(FLERR, arg[0], 1, types, low_i, high_i, error);
    utils::bounds(FLERR, arg[1], 1, types, low_j, high_j, error);
    dem_def def = dem_default_def();
    const int solid = dem_add_material(&def, 2500.0, 5e10, 0.2);
    coefficients c = {*dem_pair(&def, solid, solid), bridge_pair_default_def().angle_i};
    for (int k = 2; k < narg; k += 2)
        if (const char *bad = contact_value(&c.contact, &c.angle, arg[k], utils::numeric(FLERR, arg[k + 1], false, lmp)))
            error->all(FLERR, std::string("pair_coeff riddle/wet: ") + bad + " " + arg[k + 1] + " is not allowed here");
    for (int i = low_i; i <= high_i; i++)
        for (int j = low_j > i ? low_j : i; j <= high_j; j++) at(i, j) = at(j, i) = c, setflag[i][j] = 1;
}

/* Finds the radius of each size class. */
void PairRiddleWet::classes() {
    std::vector<double> mine(2 * class_radius.size(), 0.0), all(mine.size());
    const size_t n = class_radius.size();
    for (int i = 0; i < atom->nlocal; i++) {
        const size_t t = static_cast<size_t>(atom->type[i]);
        if (atom->radius[i] > mine[t]) mine[t] = atom->radius[i];
        if (1.0 / atom->radius[i] > mine[n + t]) mine[n + t] = 1.0 / atom->radius[i];
    }
    MPI_Allreduce(mine.data(), all.data(), static_cast<int>(mine.size()), MPI_DOUBLE, MPI_MAX, world);
    for (size_t t = 1; t < n; t++) {
        if (!(all[t] > 0.0)) error->all(FLERR, "pair_style riddle/wet: no particle of type " + std::to_string(t));
        if (all[t] * all[n + t] > 1.04) error->all(FLERR, "pair_style riddle/wet: sizes of type " + std::to_string(t) + " differ by over 4 %");
        class_radius[t] = 0.5 * (all[t] + 1.0 / all[n + t]);
    }
}

void PairRiddleWet::prepare(wet_kind *kind, int a, int b, const dem_pair_def &contact, double angle_a, double angle_b,
                            bridge_split split) const {
    bridge_pair_def def = bridge_pair_default_def();
    def.radius_i = class_radius[static_cast<size_t>(a)];
    def.radius_j = b ? class_radius[static_cast<size_t>(b)] : static_cast<double>(INFINITY);
    def.angle_i = angle_a, def.angle_j = angle_b;
    def.liquid = liquid;
    def.split = split;
    if (!b) def.volume_max = 0.02; /* its deviation is told in liquid_bridge.h: below the volume at which the neck moves */
    const bridge_status status = wet_prepare(kind, &contact, &def);
    if (status != BRIDGE_OK) error->all(FLERR, std::string("pair_style riddle/wet: ") + bridge_status_text(status));
}

void PairRiddleWet::init_style() {
    if (!atom->sphere_flag) error->all(FLERR, std::string("pair_style riddle/wet needs atom_style sphere"));
    if (force->newton_pair) error->all(FLERR, std::string("pair_style riddle/wet needs newton off"));
    if (!comm->ghost_velocity) error->all(FLERR, std::string("pair_style riddle/wet needs comm_modify vel yes"));
    if (atom->map_style == 0) error->all(FLERR, std::string("pair_style riddle/wet needs atom_modify map array"));
    const int k = modify->find_fix_by_style("^riddle/liquid$");
    books = k < 0 ? nullptr : dynamic_cast<FixRiddleLiquid *>(modify->fix[k]);
    if (!books) error->all(FLERR, std::string("pair_style riddle/wet needs a fix riddle/liquid"));
    classes();
    neighbor->request(this, instance_me);
}

/* Returns the distance of centres up to which a bridge of this kind can hold: the widest at its dynamic rupture at 10 m/s. */
double PairRiddleWet::init_one(int i, int j) {
    if (!setflag[i][j]) error->all(FLERR, std::string("pair_style riddle/wet: not all pair coeffs are set"));
    wet_kind *k = &kinds[static_cast<size_t>(i) * static_cast<size_t>(types + 1) + static_cast<size_t>(j)];
    const coefficients &c = at(i, j);
    prepare(k, i, j, c.contact, at(i, i).angle, at(j, j).angle, BRIDGE_SPLIT_NECK);
    kinds[static_cast<size_t>(j) * static_cast<size_t>(types + 1) + static_cast<size_t>(i)] = *k;
    wet_state widest;
    double smallest, largest;
    memset(&widest, 0, sizeof widest);
    bridge_volume_range(&k->bridge, class_radius[i], class_radius[j], &smallest, &largest);
    wet_form(k, class_radius[i], class_radius[j], largest, 0.0, 0, &widest);
    const double reach = bridge_rupture_gap_dynamic(widest.liquid.rupture_gap, 10.0, liquid.surface_tension, liquid.viscosity);
    for (int a = 0; a < 3; a++)
        if (domain->periodicity[a] && domain->prd[a] < 2.0 * (2.0 * class_radius[i] + reach + neighbor->skin))
            error->all(FLERR, std::string("pair_style riddle/wet: the periodic box is narrower than two cutoffs"));
    return class_radius[i] + class_radius[j] + reach;
}

/* Fills the geometry of a pair and lets its law act on both. */
void PairRiddleWet::pair_force(int i, int j, int k, wet_encounter *e) {
    wet_state *state = books->state(i, k);
    if (!state) {
        if (e->gap >= 0.0) return;
        state = books->begin(i, k);
    }
    wet_answer r;
    const int a = atom->type[i], b = atom->type[j];
    wet_force(kind(a < b ? a : b, a < b ? b : a), &liquid, e, state, &r);
    for (int d = 0; d < 3; d++) {
        atom->f[i][d] += r.force[d];
        atom->torque[i][d] += r.torque_i[d];
        if (j >= atom->nlocal) continue;
        atom->f[j][d] -= r.force[d];
        atom->torque[j][d] += r.torque_j[d];
    }
    if (update->setupflag) return;
    if (r.ruptured && books->decides(i, j)) books->wish_rupture(i, j, k);
    else if (r.touching && state->asked == 0.0 && state->liquid.volume == 0.0 && books->decides(i, j)) books->wish_bridge(i, j, k);
    else if (!r.touching && state->liquid.volume == 0.0) state->asked = 0.0;
    if (evflag)
        ev_tally_xyz(i, j, atom->nlocal, 0, 0.0, 0.0, r.force[0], r.force[1], r.force[2], e->normal[0] * (e->arm_i + e->arm_j),
                     e->normal[1] * (e->arm_i + e->arm_j), e->normal[2] * (e->arm_i + e->arm_j));
}

void PairRiddleWet::compute(int eflag, int vflag) {
    ev_init(eflag, vflag);
    double **x = atom->x, **v = atom->v, **omega = atom->omega;
    wet_encounter e;
    e.dt = update->setupflag ? 0.0 : update->dt;
    for (int ii = 0; ii < list->inum; ii++) {
        const int i = list->ilist[ii];
        for (int k = 0; k < list->numneigh[i]; k++) {
            const int j = list->firstneigh[i][k] & NEIGHMASK;
            const double sum = atom->radius[i] + atom->radius[j];
            double square = 0.0;
            for (int d = 0; d < 3; d++) e.normal[d] = x[i][d] - x[j][d], square += e.normal[d] * e.normal[d];
            if (square >= sum * sum && !books->state(i, k)) continue;
            const double distance = sqrt(square);
            for (int d = 0; d < 3; d++) {
                e.normal[d] /= distance;
                e.velocity[d] = v[i][d] - v[j][d];
                e.spin_i[d] = omega[i][d], e.spin_j[d] = omega[j][d];
            }
            e.gap = distance - sum;
            e.radius_i = atom->radius[i], e.radius_j = atom->radius[j];
            e.arm_i = distance * e.radius_i / sum, e.arm_j = distance - e.arm_i;
            e.mass_i = atom->rmass[i], e.mass_j = atom->rmass[j];
            pair_force(i, j, k, &e);
        }
    }
}

/* ---- restart ---- */

void PairRiddleWet::write_restart(FILE *file) {
    write_restart_settings(file);
    fwrite(coefficient.data(), sizeof(coefficients), coefficient.size(), file);
}

void PairRiddleWet::read_restart(FILE *file) {
    read_restart_settings(file);
    allocate();
    if (comm->me == 0) utils::sfread(FLERR, coefficient.data(), sizeof(coefficients), coefficient.size(), file, nullptr, error);
    MPI_Bcast(coefficient.data(), static_cast<int>(coefficient.size() * sizeof(coefficients)), MPI_BYTE, 0, world);
    for (int i = 1; i <= types; i++)
        for (int j = i; j <= types; j++) setflag[i][j] = 1;
}

void PairRiddleWet::write_restart_settings(FILE *file) { fwrite(&liquid, sizeof liquid, 1, file); }

void PairRiddleWet::read_restart_settings(FILE *file) {
    if (comm->me == 0) utils::sfread(FLERR, &liquid, sizeof liquid, 1, file, nullptr, error);
    MPI_Bcast(&liquid, static_cast<int>(sizeof liquid), MPI_BYTE, 0, world);
}

void *PairRiddleWet::extract(const char *name, int &dim) {
    dim = 0;
    return strcmp(name, "surface_tension") == 0 ? &liquid.surface_tension : strcmp(name, "viscosity") == 0 ? &liquid.viscosity : nullptr;
}
