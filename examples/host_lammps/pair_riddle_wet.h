/* pair_riddle_wet.h - dry contacts and liquid bridges between spheres, by wet_law.h.

       pair_style riddle/wet surface_tension S viscosity V         [N/m], [Pa s]
       pair_coeff I J stiffness K restitution E friction MU angle A [N/m], -, -, contact angle [degrees]

   All spheres of a type are of nearly one size (2 %): a type is a size class. Needs newton off, comm_modify vel yes,
   atom_modify map array and a fix riddle/liquid. */
#ifndef RIDDLE_PAIR_WET_H
#define RIDDLE_PAIR_WET_H

#include <vector>

#include "pair.h"
#include "wet_law.h"

namespace LAMMPS_NS {

class FixRiddleLiquid;

class PairRiddleWet : public Pair {
  public:
    PairRiddleWet(class LAMMPS *);
    ~PairRiddleWet() override;
    void compute(int, int) override;
    void settings(int, char **) override;
    void coeff(int, char **) override;
    void init_style() override;
    double init_one(int, int) override;
    void write_restart(FILE *) override;
    void read_restart(FILE *) override;
    void write_restart_settings(FILE *) override;
    void read_restart_settings(FILE *) override;
    void *extract(const char *, int &) override;

    /* Prepares a kind of pair for size classes a and b; b = 0: a wall. */
    void prepare(wet_kind *kind, int a, int b, const dem_pair_def &contact, double angle_a, double angle_b,
                 bridge_split split) const;
    const wet_kind *kind(int a, int b) const { return &kinds[(size_t)a * (size_t)(types + 1) + (size_t)b]; }

    bridge_liquid liquid;

  private:
    struct coefficients {
        dem_pair_def contact;
        double angle;
    };
    coefficients &at(int a, int b) { return coefficient[(size_t)a * (size_t)(types + 1) + (size_t)b]; }
    void allocate();
    void classes();
    void pair_force(int, int, int, wet_encounter *);

    int types;
    FixRiddleLiquid *books;
    std::vector<coefficients> coefficient;
    std::vector<wet_kind> kinds;
    std::vector<double> class_radius; /* by type [m] */
};

} // namespace LAMMPS_NS

#endif
