// A C++ host with its own particles and its own loop: it asks for the bridge's forces only. Two wet spheres part; the liquid is kept.
#include <riddle/liquid_bridge.h>

#include <cmath>
#include <cstdio>
#include <vector>

struct Grain {
    double x, v, radius, mass, liquid;
};

int main() {
    std::vector<Grain> grains = {{0.0, -0.05, 2.5e-3, 1.6e-4, 1e-10}, {5e-3, 0.05, 2.5e-3, 1.6e-4, 1e-10}};
    const double liquid = grains[0].liquid + grains[1].liquid, dt = 1e-6;
    bridge_pair_def def = bridge_pair_default_def();
    bridge_pair pair;
    bridge between;
    if (bridge_pair_prepare(&pair, &def) != BRIDGE_OK) return 1;
    if (bridge_form(&pair, grains[0].radius, grains[1].radius, grains[0].liquid, grains[1].liquid, 0, &between) != BRIDGE_OK) return 2;
    grains[0].liquid = grains[1].liquid = 0.0;
    int steps = 0;
    for (; steps < 1000000; steps++) {
        const double gap = grains[1].x - grains[0].x - grains[0].radius - grains[1].radius, velocity = grains[1].v - grains[0].v;
        if (bridge_is_ruptured(&between, &def.liquid, gap, velocity)) break;
        const double force = bridge_evaluate(&between, &def.liquid, gap, velocity).normal;
        grains[0].v += dt * force / grains[0].mass;
        grains[1].v -= dt * force / grains[1].mass;
        for (Grain &g : grains) g.x += dt * g.v;
    }
    const double share = between.split;
    grains[0].liquid = share * between.volume;
    grains[1].liquid = between.volume - grains[0].liquid;
    std::printf("parted after %d steps at %.4f m/s, shares %.3f\n", steps, grains[1].v - grains[0].v, share);
    const bool kept = std::fabs(grains[0].liquid + grains[1].liquid - liquid) < 1e-12 * liquid;
    return kept && steps > 100 && grains[1].v - grains[0].v < 0.1 ? 0 : 3;
}
