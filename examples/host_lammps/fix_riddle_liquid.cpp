#include "fix_riddle_liquid.h"

#include <algorithm>
#include <cstring>

#include "atom.h"
#include "comm.h"
#include "error.h"
#include "fix_riddle_wall.h"
#include "force.h"
#include "modify.h"
#include "neigh_list.h"
#include "pair_riddle_wet.h"
#include "update.h"

using namespace LAMMPS_NS;

enum { MAX_WISHES = 14, PAIR_SIZE = 1 + WET_STATE_SIZE, GLOBAL_SIZE = 3 };
enum { FILMS_AND_WISHES, FRACTIONS };

/* Keeps the sum of what is given below what is there, whatever the roundings of film/demand. */
static const double just_below_one = 1.0 - 1e-14;

FixRiddleLiquid::FixRiddleLiquid(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg) {
    if (narg != 5 || strcmp(arg[3], "moisture") != 0) error->all(FLERR, std::string("fix riddle/liquid: expected 'moisture SHARE'"));
    moisture = utils::numeric(FLERR, arg[4], false, lmp);
    if (!(moisture >= 0.0 && moisture <= 0.1)) error->all(FLERR, std::string("fix riddle/liquid: moisture must be 0 .. 0.1"));
    restart_global = restart_peratom = 1;
    vector_flag = 1, size_vector = 5, global_freq = 1, extvector = 1;
    nevery = 1;
    comm_forward = 2 + MAX_WISHES;
    maxexchange_dynamic = 1;
    maxexchange = 2;
    pair = nullptr;
    quantum = initial = ruptures = 0.0;
    has_lists = filled = false;
    phase = FILMS_AND_WISHES;
    FixRiddleLiquid::grow_arrays(atom->nmax);
    atom->add_callback(Atom::GROW);
    atom->add_callback(Atom::RESTART);
    for (int i = 0; i < atom->nlocal; i++) FixRiddleLiquid::set_arrays(i);
}

FixRiddleLiquid::~FixRiddleLiquid() {
    atom->delete_callback(id, Atom::GROW);
    atom->delete_callback(id, Atom::RESTART);
}

int FixRiddleLiquid::setmask() { return FixConst::PRE_EXCHANGE | FixConst::POST_NEIGHBOR | FixConst::END_OF_STEP; }

tagint FixRiddleLiquid::tag(int i) const { return atom->tag[i]; }
double FixRiddleLiquid::radius(int i) const { return atom->radius[i]; }
bool FixRiddleLiquid::decides(int i, int j) const {
    return (j < atom->nlocal || atom->tag[i] < atom->tag[j]) && told[i].size() < MAX_WISHES;
}

/* Gives every particle its first film: a share of its mass. */
void FixRiddleLiquid::init() {
    pair = dynamic_cast<PairRiddleWet *>(force->pair_match("riddle/wet", 1));
    if (!pair) error->all(FLERR, std::string("fix riddle/liquid needs pair_style riddle/wet"));
    if (filled) return;
    double largest = 0.0, all = 0.0, here = 0.0;
    for (int i = 0; i < atom->nlocal; i++) largest = std::max(largest, moisture * atom->rmass[i] / 1000.0);
    MPI_Allreduce(&largest, &all, 1, MPI_DOUBLE, MPI_MAX, world);
    quantum = bridge_quantum(all > 0.0 ? all * static_cast<double>(atom->natoms) : 1e-6);
    for (int i = 0; i < atom->nlocal; i++) here += film[i] = bridge_quantised(moisture * atom->rmass[i] / 1000.0, quantum);
    MPI_Allreduce(&here, &initial, 1, MPI_DOUBLE, MPI_SUM, world);
    filled = true;
}

/* ---- pairs, from list to list and from rank to rank ---- */

/* Tells a pair from the other particle's side. The bridge is stored the same on both: as the lesser id sees it. */
static wet_state from_the_other_side(wet_state state) {
    for (double &s : state.slip) s = -s;
    return state;
}

void FixRiddleLiquid::carry(int i, int j, const wet_state &state, bool turned) {
    carried[i].push_back(carried_pair{tag(j), turned ? from_the_other_side(state) : state});
}

void FixRiddleLiquid::pre_exchange() {
    if (!has_lists) return;
    size_t most = 0;
    for (int i = 0; i < atom->nlocal; i++) carried[i].clear();
    for (const entry &e : live) {
        if (e.state.asked == 0.0 && e.state.liquid.volume == 0.0) continue;
        carry(e.i, e.j, e.state, false);
        if (e.j < atom->nlocal) carry(e.j, e.i, e.state, true);
    }
    for (int i = 0; i < atom->nlocal; i++) most = std::max(most, carried[i].size());
    maxexchange = 2 + static_cast<int>(most) * PAIR_SIZE;
}

void FixRiddleLiquid::setup_pre_exchange() { pre_exchange(); }

/* Between runs particles may move, vanish or go into a file without a word: pairs are kept by their ids. */
void FixRiddleLiquid::post_run() {
    pre_exchange();
    has_lists = false;
    live.clear();
}

/* Finds the pairs in the new neighbour list. */
void FixRiddleLiquid::post_neighbor() {
    const NeighList *list = pair->list;
    live.clear();
    first.assign(static_cast<size_t>(atom->nlocal), 0);
    slot.clear();
    for (int ii = 0; ii < list->inum; ii++) {
        const int i = list->ilist[ii];
        first[i] = static_cast<int>(slot.size());
        for (int k = 0; k < list->numneigh[i]; k++) {
            const int j = list->firstneigh[i][k] & NEIGHMASK;
            slot.push_back(-1);
            for (const carried_pair &c : carried[i]) {
                if (c.partner != tag(j)) continue;
                slot.back() = static_cast<int>(live.size());
                live.push_back(entry{i, j, c.state});
                break;
            }
        }
    }
    has_lists = true;
}

void FixRiddleLiquid::setup_post_neighbor() { post_neighbor(); }

wet_state *FixRiddleLiquid::begin(int i, int k) {
    int &place = slot[first[i] + k];
    place = static_cast<int>(live.size());
    live.push_back(entry{i, pair->list->firstneigh[i][k] & NEIGHMASK, wet_state()});
    return &live.back().state;
}

/* ---- the liquid of a step ---- */

const wet_kind *FixRiddleLiquid::kind_of(int low, int high, int *swapped) const {
    const int a = atom->type[low], b = atom->type[high];
    *swapped = a > b;
    return pair->kind(std::min(a, b), std::max(a, b));
}

void FixRiddleLiquid::end_of_step() {
    comm->forward_comm_fix(this);
    hear_wishes();
    hear_walls();
    for (int i = 0; i < atom->nlocal; i++) demand[i] = demand[i] > film[i] ? just_below_one * film[i] / demand[i] : 1.0; /* now a fraction */
    phase = FRACTIONS;
    comm->forward_comm_fix(this);
    phase = FILMS_AND_WISHES;
    give();
}

void FixRiddleLiquid::hear_wishes() {
    const NeighList *list = pair->list;
    births.clear();
    const int all = atom->nlocal + atom->nghost;
    for (int i = 0; i < all; i++) {
        for (const wish &q : told[i]) {
            if (i < atom->nlocal) {
                hear(i, q.j, q.k, q.rupture);
                continue;
            }
            const int m = atom->map(q.partner);
            if (m < 0 || m >= atom->nlocal) continue;
            for (int k = 0; k < list->numneigh[m]; k++)
                if ((list->firstneigh[m][k] & NEIGHMASK) == i) hear(m, i, k, q.rupture);
        }
        told[i].clear();
    }
}

void FixRiddleLiquid::hear(int i, int j, int k, int ruptured) {
    if (ruptured) {
        rupture(i, j, k);
        return;
    }
    const int low = tag(i) < tag(j) ? i : j, high = low == i ? j : i;
    birth b = {i, j, k, 0.0, 0.0};
    int swapped;
    wet_offer(kind_of(low, high, &swapped), film[low], film[high], radius(low), radius(high), quantum, &b.offer_low, &b.offer_high);
    wet_state *s = state(i, k);
    if (!s) s = begin(i, k);
    s->asked = 1.0;
    demand[low] += b.offer_low; /* a ghost's sum is not read: its own rank knows all that it is asked for */
    demand[high] += b.offer_high;
    births.push_back(b);
}

void FixRiddleLiquid::rupture(int i, int j, int k) {
    wet_state *s = state(i, k);
    if (!s || s->liquid.volume == 0.0) return;
    const double to_low = wet_split(s, quantum), to_high = s->liquid.volume - to_low;
    const bool is_low = tag(i) < tag(j);
    returned[i] += is_low ? to_low : to_high;
    if (j < atom->nlocal) returned[j] += is_low ? to_high : to_low;
    if (j < atom->nlocal || is_low) ruptures += 1.0;
    memset(&s->liquid, 0, sizeof s->liquid);
    s->asked = 0.0;
}

void FixRiddleLiquid::wall_rupture(int i, wet_state *s) {
    returned[i] += s->liquid.volume; /* each takes back what it gave, and the wall is dry */
    ruptures += 1.0;
    memset(&s->liquid, 0, sizeof s->liquid);
    s->asked = 0.0;
}

void FixRiddleLiquid::hear_walls() {
    wall_offers.clear();
    for (const wall_wish &q : walls) {
        double offer, none;
        wet_offer(q.kind, film[q.i], 0.0, radius(q.i), static_cast<double>(INFINITY), quantum, &offer, &none);
        demand[q.i] += offer;
        wall_offers.push_back(offer);
    }
}

void FixRiddleLiquid::give() {
    for (const birth &b : births) {
        const int low = tag(b.i) < tag(b.j) ? b.i : b.j, high = low == b.i ? b.j : b.i;
        const double from_low = bridge_quantised(demand[low] * b.offer_low, quantum);
        const double from_high = bridge_quantised(demand[high] * b.offer_high, quantum);
        int swapped;
        const wet_kind *kind = kind_of(low, high, &swapped);
        if (!wet_form(kind, radius(low), radius(high), from_low, from_high, swapped, state(b.i, b.k))) continue;
        returned[low] -= from_low;
        returned[high] -= from_high;
    }
    for (size_t k = 0; k < walls.size(); k++) {
        const wall_wish &q = walls[k];
        const double given = bridge_quantised(demand[q.i] * wall_offers[k], quantum);
        if (wet_form(q.kind, radius(q.i), static_cast<double>(INFINITY), given, 0.0, 0, q.state)) returned[q.i] -= given;
    }
    walls.clear();
    for (int i = 0; i < atom->nlocal + atom->nghost; i++) {
        film[i] += returned[i];
        returned[i] = demand[i] = 0.0;
    }
}

int FixRiddleLiquid::pack_forward_comm(int n, int *list, double *buf, int, int *) {
    int m = 0;
    for (int k = 0; k < n; k++) {
        const int i = list[k];
        if (phase == FRACTIONS) {
            buf[m++] = demand[i];
            continue;
        }
        buf[m++] = film[i];
        buf[m++] = static_cast<double>(told[i].size());
        for (const wish &q : told[i]) buf[m++] = static_cast<double>(q.rupture ? -q.partner : q.partner);
    }
    return m;
}

void FixRiddleLiquid::unpack_forward_comm(int n, int from, double *buf) {
    int m = 0;
    for (int i = from; i < from + n; i++) {
        if (phase == FRACTIONS) {
            demand[i] = buf[m++];
            continue;
        }
        film[i] = buf[m++];
        told[i].clear();
        for (int left = static_cast<int>(buf[m++]); left > 0; left--, m++) {
            const tagint partner = static_cast<tagint>(buf[m] < 0.0 ? -buf[m] : buf[m]);
            told[i].push_back(wish{partner, buf[m] < 0.0, -1, -1});
        }
    }
}

/* ---- reading ---- */

double FixRiddleLiquid::compute_vector(int n) {
    double mine[5] = {0.0, 0.0, 0.0, ruptures, 0.0}, all[5];
    for (int k = 0; k < modify->nfix; k++)
        if (const FixRiddleWall *wall = dynamic_cast<FixRiddleWall *>(modify->fix[k])) wall->count(&mine[0], &mine[1]);
    for (int i = 0; i < atom->nlocal; i++) mine[1] += film[i];
    for (const entry &e : live) {
        const bool both = e.j < atom->nlocal, is_low = tag(e.i) < tag(e.j);
        const double volume = e.state.liquid.volume, to_low = wet_split(&e.state, quantum);
        if (volume == 0.0) continue;
        mine[0] += both || is_low ? 1.0 : 0.0;
        mine[4] += both ? 0.0 : is_low ? 1.0 : -1.0;
        mine[1] += both ? volume : is_low ? to_low : volume - to_low; /* of a pair on two ranks each counts its side */
    }
    for (int i = 0; i < atom->nlocal && !has_lists; i++) {
        for (const carried_pair &c : carried[i]) {
            const double volume = c.state.liquid.volume, to_low = wet_split(&c.state, quantum);
            mine[0] += volume > 0.0 && tag(i) < c.partner ? 1.0 : 0.0;
            mine[1] += tag(i) < c.partner ? to_low : volume - to_low;
        }
    }
    MPI_Allreduce(mine, all, 5, MPI_DOUBLE, MPI_SUM, world); /* volumes are multiples of the quantum: exact in any order */
    all[2] = initial;
    return all[n];
}

double FixRiddleLiquid::memory_usage() {
    return static_cast<double>(live.capacity() * sizeof(entry) + slot.capacity() * sizeof(int)) +
           static_cast<double>(film.capacity()) * (3.0 * sizeof(double) + sizeof(told[0]) + sizeof(carried[0]));
}

/* ---- arrays by particle ---- */

void FixRiddleLiquid::grow_arrays(int n) {
    const size_t size = static_cast<size_t>(n);
    film.resize(size, 0.0);
    returned.resize(size, 0.0);
    demand.resize(size, 0.0);
    told.resize(size);
    carried.resize(size);
}

void FixRiddleLiquid::copy_arrays(int i, int j, int) {
    film[j] = film[i];
    carried[j] = carried[i];
}

void FixRiddleLiquid::set_arrays(int i) {
    film[i] = 0.0;
    carried[i].clear();
}

int FixRiddleLiquid::pack_pairs(const std::vector<carried_pair> &pairs, double *buf) {
    int m = 0;
    buf[m++] = static_cast<double>(pairs.size());
    for (const carried_pair &c : pairs) {
        buf[m++] = static_cast<double>(c.partner);
        memcpy(&buf[m], &c.state, sizeof c.state);
        m += WET_STATE_SIZE;
    }
    return m;
}

int FixRiddleLiquid::pack_exchange(int i, double *buf) {
    buf[0] = film[i];
    return 1 + pack_pairs(carried[i], buf + 1);
}

int FixRiddleLiquid::unpack_exchange(int i, double *buf) {
    int m = 0;
    film[i] = buf[m++];
    carried[i].resize(static_cast<size_t>(buf[m++]));
    for (carried_pair &c : carried[i]) {
        c.partner = static_cast<tagint>(buf[m++]);
        memcpy(static_cast<void *>(&c.state), &buf[m], sizeof c.state);
        m += WET_STATE_SIZE;
    }
    return m;
}

/* ---- restart ---- */

void FixRiddleLiquid::write_restart(FILE *file) {
    double all;
    MPI_Allreduce(&ruptures, &all, 1, MPI_DOUBLE, MPI_SUM, world);
    if (comm->me != 0) return;
    const double data[GLOBAL_SIZE] = {quantum, initial, all};
    const int size = sizeof data;
    fwrite(&size, sizeof size, 1, file);
    fwrite(data, sizeof data, 1, file);
}

void FixRiddleLiquid::restart(char *buf) {
    double data[GLOBAL_SIZE];
    memcpy(data, buf, sizeof data);
    quantum = data[0], initial = data[1];
    ruptures = comm->me == 0 ? data[2] : 0.0;
    filled = true;
}

int FixRiddleLiquid::maxsize_restart() { return maxexchange + 1; }

/* LAMMPS asks for the size of every particle's data before it takes the first. */
int FixRiddleLiquid::size_restart(int i) {
    if (i == 0) pre_exchange(); /* a restart file in the middle of a run */
    return 3 + static_cast<int>(carried[i].size()) * PAIR_SIZE;
}

int FixRiddleLiquid::pack_restart(int i, double *buf) {
    buf[0] = static_cast<double>(1 + pack_exchange(i, buf + 1));
    return static_cast<int>(buf[0]);
}

void FixRiddleLiquid::unpack_restart(int i, int nth) {
    double *data = atom->extra[i];
    for (int k = 0; k < nth; k++) data += static_cast<int>(*data);
    unpack_exchange(i, data + 1);
}
