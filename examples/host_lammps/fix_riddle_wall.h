/* fix_riddle_wall.h - a wall for wet spheres. It supplies geometry (distance, normal, surface velocity); the rest is
   wet_law.h's.

       fix ID all riddle/wall CONTACT plane x|y|z POSITION [wiggle AMPLITUDE PERIOD]
       fix ID all riddle/wall CONTACT cylinder RADIUS SPIN

   CONTACT as in pair_coeff: stiffness K restitution E friction MU angle A. A plane has its spheres on the greater side;
   it moves along its normal by A (1 - cos(2 pi t/PERIOD)). A cylinder has the axis x = y = 0 and its spheres inside; it
   turns with SPIN [rad/s]. Walls stay dry: at rupture a sphere takes back what it gave. Give the fix after fix
   riddle/liquid. */
#ifndef RIDDLE_FIX_WALL_H
#define RIDDLE_FIX_WALL_H

#include <vector>

#include "fix.h"
#include "wet_law.h"

namespace LAMMPS_NS {

class FixRiddleLiquid;
class PairRiddleWet;

class FixRiddleWall : public Fix {
  public:
    FixRiddleWall(class LAMMPS *, int, char **);
    ~FixRiddleWall() override;
    int setmask() override;
    void init() override;
    void setup(int) override;
    void post_force(int) override;
    void grow_arrays(int) override;
    void copy_arrays(int, int, int) override;
    void set_arrays(int) override;
    int pack_exchange(int, double *) override;
    int unpack_exchange(int, double *) override;
    int pack_restart(int, double *) override;
    void unpack_restart(int, int) override;
    int size_restart(int) override;
    int maxsize_restart() override;
    void count(double *bridges, double *volume) const; /* adds this rank's bridges and their liquid [m3] */

  private:
    bool meet(int i, wet_encounter *) const;
    void act(int i, wet_encounter *);

    dem_pair_def contact;
    double angle, position, amplitude, period, cylinder_radius, cylinder_spin;
    int axis; /* of a plane; -1: cylinder */
    FixRiddleLiquid *books;
    PairRiddleWet *pair;
    std::vector<wet_kind> kinds; /* by type */
    std::vector<wet_state> states;
};

} // namespace LAMMPS_NS

#endif
