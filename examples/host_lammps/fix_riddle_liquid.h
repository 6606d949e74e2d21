/* fix_riddle_liquid.h - who has which liquid. Owns the film of every particle and the state of every pair; takes both
   along when particles change ranks, when neighbour lists are made anew, and into restart files.

       fix ID all riddle/liquid moisture SHARE      mass of water over mass of spheres

   f_ID[1] bridges, f_ID[2] liquid [m3] (films and bridges), f_ID[3] liquid at the start [m3], f_ID[4] ruptures so far,
   f_ID[5] bridges that only one of their two ranks knows: 0, or the books are wrong.

   A pair whose particles live on two ranks is stored on both. Both copies must agree on when a bridge forms and
   ruptures, though their distances may differ in the last bit across a periodic border. So the rank of the lesser id
   decides; it tells the other in a message of the same step, and both then compute the new bridge from the same
   numbers. Forces of a new bridge begin in the next step. */
#ifndef RIDDLE_FIX_LIQUID_H
#define RIDDLE_FIX_LIQUID_H

#include <vector>

#include "fix.h"
#include "lammps.h"
#include "wet_law.h"

namespace LAMMPS_NS {

class PairRiddleWet;

class FixRiddleLiquid : public Fix {
  public:
    FixRiddleLiquid(class LAMMPS *, int, char **);
    ~FixRiddleLiquid() override;
    int setmask() override;
    void init() override;
    void setup_pre_exchange() override;
    void pre_exchange() override;
    void setup_post_neighbor() override;
    void post_neighbor() override;
    void end_of_step() override;
    void post_run() override;
    double compute_vector(int) override;
    double memory_usage() override;

    void grow_arrays(int) override;
    void copy_arrays(int, int, int) override;
    void set_arrays(int) override;
    int pack_forward_comm(int, int *, double *, int, int *) override;
    void unpack_forward_comm(int, int, double *) override;
    int pack_exchange(int, double *) override;
    int unpack_exchange(int, double *) override;
    void write_restart(FILE *) override;
    void restart(char *) override;
    int pack_restart(int, double *) override;
    void unpack_restart(int, int) override;
    int size_restart(int) override;
    int maxsize_restart() override;

    /* State of the pair at place k of the neighbour list of particle i; NULL: the pair has none. */
    wet_state *state(int i, int k) {
        const int place = slot[first[i] + k];
        return place < 0 ? nullptr : &live[place].state;
    }
    wet_state *begin(int i, int k);
    /* Wishes, heard at the end of the step. Only the rank that decides about the pair may utter them. */
    void wish_bridge(int i, int j, int k) { told[i].push_back(wish{tag(j), 0, j, k}); }
    void wish_rupture(int i, int j, int k) { told[i].push_back(wish{tag(j), 1, j, k}); }
    bool decides(int i, int j) const; /* is it this rank's copy of the pair that decides? */
    void wish_wall_bridge(int i, const wet_kind *kind, wet_state *state) { walls.push_back(wall_wish{i, kind, state}); }
    void wall_rupture(int i, wet_state *state);
    double quantum; /* [m3] */

  private:
    struct entry { /* a pair while its particles keep their places in the neighbour list */
        int i, j;
        wet_state state;
    };
    struct wish {
        tagint partner;
        int rupture, j, k;
    };
    struct wall_wish {
        int i;
        const wet_kind *kind;
        wet_state *state;
    };
    struct birth { /* a bridge about to form, with the offers of the lesser and of the greater id */
        int i, j, k;
        double offer_low, offer_high;
    };
    struct carried_pair { /* a pair while its particles have no places: by the partner's id */
        tagint partner;
        wet_state state;
    };

    tagint tag(int i) const;
    double radius(int i) const;
    const wet_kind *kind_of(int low, int high, int *swapped) const;
    void carry(int i, int j, const wet_state &state, bool turned);
    int find_place(int i, tagint partner) const;
    void hear(int i, int j, int k, int rupture);
    void hear_wishes();
    void hear_walls();
    void give();
    void rupture(int i, int j, int k);
    static int pack_pairs(const std::vector<carried_pair> &, double *);

    PairRiddleWet *pair;
    double moisture, initial, ruptures;
    bool has_lists, filled;
    int phase;
    /* By particle, ghosts too: film [m3], liquid back from ruptures [m3], sum of offers. */
    std::vector<double> film, returned, demand;
    std::vector<std::vector<wish>> told;        /* by particle, ghosts too */
    std::vector<std::vector<carried_pair>> carried;
    std::vector<entry> live;
    std::vector<int> first, slot;
    std::vector<birth> births;
    std::vector<wall_wish> walls;
    std::vector<double> wall_offers;
};

} // namespace LAMMPS_NS

#endif
