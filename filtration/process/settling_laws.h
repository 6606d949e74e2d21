/* Settling of a single sphere: Stokes' law, inertia, side walls, bottom; for comparison with a resolved simulation.
   Relies on base.h, the portable mathematics. */
#pragma once
#include "../base/base.h"
#include "../../base/portable_math.h"

/* ==== >>settling: drag of one sphere over Stokes' 3 pi mu d v [-]; NaN outside the stated range ==== */

/* Returns the terminal velocity by Stokes' law, (density difference) g d^2 / (18 mu) [m/s]; d > 0 [m], mu > 0 [Pa s].
   */
static inline double filtration_stokes_velocity(double density_difference, double gravity, double d, double mu) {
    return d > 0.0 && mu > 0.0 ? density_difference * gravity * d * d / (18.0 * mu) : (double)NAN;
}

/* Returns the factor of inertia, Schiller and Naumann (1935): 1 + 0.15 Re^0.687, 0 <= Re <= 1000, Re = v d rho / mu. */
static inline double filtration_schiller_naumann(double reynolds) {
    return reynolds >= 0.0 && reynolds <= 1000.0 ? 1.0 + 0.15 * riddle_pow(reynolds, 0.687) : (double)NAN;
}

/* Returns the factor on the axis of a cylinder of diameter D; ratio = d / D, 0 .. below 1. The paper's (13): Ladenburg
   (1907) with Faxen's constant, first order. */
static inline double filtration_wall_ladenburg(double ratio) {
    return ratio >= 0.0 && ratio < 1.0 ? 1.0 + 2.104 * ratio : (double)NAN;
}

/* Returns the same by Faxen (1922): good to a ratio of about 0.3; NaN from 0.6 on. */
static inline double filtration_wall_faxen(double ratio) {
    if (!(ratio >= 0.0 && ratio < 0.6)) return (double)NAN;
    const double cube = ratio * ratio * ratio;
    return 1.0 / (1.0 - 2.104 * ratio + 2.09 * cube - 0.95 * cube * ratio * ratio);
}

/* Returns the same by Haberman and Sayre (1958): to 2 % up to a ratio of 0.5; NaN from 0.8 on. */
static inline double filtration_wall_haberman_sayre(double ratio) {
    if (!(ratio >= 0.0 && ratio < 0.8)) return (double)NAN;
    const double cube = ratio * ratio * ratio, fifth = cube * ratio * ratio;
    return (1.0 - 0.75857 * fifth) / (1.0 - 2.1050 * ratio + 2.0865 * cube - 1.7068 * fifth + 0.72603 * fifth * ratio);
}

/* Returns the factor towards a plane by Brenner (1961), without inertia; gap over the radius > 0. Exact; below 1e-3 the
   two leading terms of lubrication. */
static inline double filtration_wall_brenner(double gap_over_radius) {
    const double gap = gap_over_radius;
    if (!(gap > 0.0)) return (double)NAN;
    if (gap < 1e-3) return 1.0 / gap - 0.2 * riddle_log(gap) + 0.9713;
    if (gap > 1e6) return 1.0 + 1.125 / gap;
    const double alpha = riddle_log1p(gap + sqrt(gap * (gap + 2.0))), sinh_1 = sqrt(gap * (gap + 2.0)),
                 sinh_2 = 2.0 * sinh_1 * (1.0 + gap);
    double sum = 0.0;
    for (int n = 1; n < 2000; n++) { /* every hyperbolic function is divided by exp((2n + 1) alpha) / 2 */
        const double odd = 2.0 * n + 1.0, e = riddle_exp(-odd * alpha), scale = 2.0 * e;
        const double upper = 2.0 * (1.0 - e * e) + scale * odd * sinh_2;
        const double lower = 2.0 * (1.0 - e) * (1.0 - e) - scale * odd * odd * sinh_1 * sinh_1;
        const double term = n * (n + 1.0) / ((odd - 2.0) * (odd + 2.0)) * (upper / lower - 1.0);
        sum += term;
        if (term < 1e-16 * sum) break;
    }
    return 4.0 / 3.0 * sinh_1 * sum;
}
