/* host_lammps - LAMMPS with Riddle's wet laws: the same command line and input language, and the styles riddle/wet (pair), riddle/liquid
   and riddle/wall (fixes).

       mpirun -n 2 host_lammps -in bed.lammps

   To change for your own case: the input (bed.lammps and drum.lammps show a bed and a drum); the law (wet_law.h).

   LAMMPS is free software under the GNU General Public License, version 2. This program links to its library and includes its headers;
   a binary of it is therefore under that licence. The files of this folder are under Riddle's. */
#include <mpi.h>

#include "fix_riddle_liquid.h"
#include "fix_riddle_wall.h"
#include "force.h"
#include "input.h"
#include "lammps.h"
#include "modify.h"
#include "pair_riddle_wet.h"

using namespace LAMMPS_NS;

template <class Style> static Fix *new_fix(LAMMPS *lmp, int narg, char **arg) { return new Style(lmp, narg, arg); }
static Pair *new_pair(LAMMPS *lmp) { return new PairRiddleWet(lmp); }

int main(int argc, char **argv) {
    MPI_Init(&argc, &argv);
    LAMMPS *lmp = new LAMMPS(argc, argv, MPI_COMM_WORLD);
    (*lmp->force->pair_map)["riddle/wet"] = new_pair;
    (*lmp->modify->fix_map)["riddle/liquid"] = new_fix<FixRiddleLiquid>;
    (*lmp->modify->fix_map)["riddle/wall"] = new_fix<FixRiddleWall>;
    lmp->input->file();
    delete lmp;
    MPI_Finalize();
    return 0;
}
