/* How bodies are oriented: order tensor, order parameter. Reads a const world. */
#pragma once
#include "../bodies/getters.h"
#include "measure.h"

/* Diagonalises the symmetric matrix m by Jacobi's rotations: m becomes the diagonal matrix of its eigenvalues; the
   columns of v are their directions. */
static inline void dem__diagonalise(double m[3][3], double v[3][3]) {
    for (int a = 0; a < 9; a++) v[a / 3][a % 3] = a % 4 == 0;
    for (int turns = 0; turns < 60; turns++) {
        const int p = turns % 3 == 2 ? 1 : 0, q = turns % 3 == 0 ? 1 : 2;
        if (m[p][q] == 0.0) continue;
        const double theta = 0.5 * (m[q][q] - m[p][p]) / m[p][q];
        const double t = (theta < 0.0 ? -1.0 : 1.0) / (fabs(theta) + sqrt(theta * theta + 1.0));
        const double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
        for (int k = 0; k < 3; k++) {
            const double of_p = m[k][p], of_q = m[k][q];
            m[k][p] = c * of_p - s * of_q, m[k][q] = s * of_p + c * of_q;
        }
        for (int k = 0; k < 3; k++) {
            const double of_p = m[p][k], of_q = m[q][k], at_p = v[k][p], at_q = v[k][q];
            m[p][k] = c * of_p - s * of_q, m[q][k] = s * of_p + c * of_q;
            v[k][p] = c * at_p - s * at_q, v[k][q] = s * at_p + c * at_q;
        }
    }
}

DEM_API dem_status dem_measure_order(const dem_world *world, const dem_region *region, int axis, dem_order *order) {
    const dem_world *w = world;
    if (!w || !w->def.allocator.fn || !order || axis < 0 || axis > 2 || (region && !dem__is_region(region)))
        return DEM_BAD_ARGUMENT;
    const dem_vec own = dem_vec3(axis == 0, axis == 1, axis == 2);
    double sum[3][3], turned[3][3], direction[3][3];
    int first = 0;
    memset(order, 0, sizeof *order);
    memset(sum, 0, sizeof sum);
    for (ptrdiff_t i = 0; i < w->count; i++) {
        dem_vec x, v;
        if (!w->alive[i] || !dem__rigid_of(w, i) || !dem__counts(w, i, &x, &v)) continue;
        if (region && !dem_region_holds(region, x)) continue;
        const dem_vec u = dem__to_lab(dem_orientation(w, i), own);
        for (int a = 0; a < 9; a++)
            sum[a / 3][a % 3] += 1.5 * dem_axis(u, a / 3) * dem_axis(u, a % 3) - (a % 4 == 0 ? 0.5 : 0.0);
        order->bodies++;
    }
    for (int a = 0; a < 9; a++)
        order->tensor[a / 3][a % 3] = turned[a / 3][a % 3] = sum[a / 3][a % 3] / (double)order->bodies; /* none: NaN */
    dem__diagonalise(turned, direction);
    for (int k = 1; k < 3; k++) {
        if (turned[k][k] > turned[first][first]) first = k;
    }
    order->parameter = turned[first][first];
    order->director = dem_vec3(direction[0][first], direction[1][first], direction[2][first]);
    return DEM_OK;
}
