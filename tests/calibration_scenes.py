#!/usr/bin/env python3
"""Known parameters of small scenes (a fifth of a second a run), found again by riddle.calibrate from results of the
same scenes with other seeds: friction alone from a column that collapses; friction and rolling friction from that and
from trestles that slide to their rest. Leaves with 1 where the 95 % range of a parameter holds it in fewer than 17 of
20 trials. Needs the binding (python/build).
  tests/calibration_scenes.py [TRIALS] [SEED]     20 trials by default"""
import os
import sys

import numpy as np

here = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [here, os.path.join(here, "..", "python")]
from calibration_trials import P, calibrate  # noqa: E402
from riddle import dem  # noqa: E402

FRICTION, ROLLING = P("friction", 0.1, 0.7), P("rolling", 0.01, 0.3, True)
# parameters, results, runs
CASES = {"one": ([FRICTION], ["run_out_m"], 12), "two": ([FRICTION, ROLLING], ["run_out_m", "height_m", "way_m"], 20)}
REPEATS = 8  # of what is measured


def begin(values, depth=0.0):
    definition = dem.def_(dt=2e-5)
    stuff = dem.add_material(definition, 2500.0, 1e8, 0.25)
    contact = dem.pair(definition, stuff, stuff)
    contact.stiffness, contact.restitution, contact.friction = 1e3, 0.4, values["friction"]
    if depth > 0.0:
        definition.low, definition.high, definition.periodic = (0.0, 0.0, -1.0), (1.0, depth, 1.0), (0, 1, 0)
    world, law = dem.World(definition), dem.ContactLaw("epsd")
    law.pair(stuff, stuff).rolling = values.get("rolling", 0.05)
    world.add_plane(stuff, (0, 0, 0), (0, 0, 1))
    return world, law, stuff


def collapse(values, seed):
    """60 spheres of 4 to 5 mm behind a gate, periodic across: the centre of their mass after the gate has opened."""
    world, law, stuff = begin(values, 0.014)
    world.add_plane(stuff, (0, 0, 0), (1, 0, 0))
    gate, feed = world.add_plane(stuff, (0.017, 0, 0), (-1, 0, 0)), dem.default_feed()
    feed.material, feed.sizes, feed.random = stuff, dem.uniform_sizes(0.004, 0.005, 0), seed
    feed.region = dem.box_region((0, 0, 0), (0.017, 0.014, 0.1))
    world.fill(feed, 60)
    world.run_law(0.15, law)
    world.enable_wall(gate, 0)
    world.run_law(0.35, law)
    centre = np.average(world.positions(), axis=0, weights=world.masses())
    return {"run_out_m": centre[0], "height_m": centre[2]}


def slide(values, seed):
    """Six trestles of three spheres that are thrown along the floor: how far they come."""
    world, law, stuff = begin(values)
    rng, six = np.random.default_rng(seed), range(6)
    at = [(0.01 * np.cos(a), 0.01 * np.sin(a), 0.0) for a in (0.0, 2.1, 4.2)]
    clump = dem.make_clump(at, [0.006] * 3)
    turned = [(np.cos(a), 0.0, 0.0, np.sin(a)) for a in rng.uniform(0.0, np.pi, 6)]
    world.add_clumps(clump, [(0.0, 0.04 * k, 0.0031) for k in six], None, turned, stuff, 0)
    for k in six:
        world.set_motion(3 * k, (rng.normal(0.6, 0.03), 0.0, 0.0), (0.0, 0.0, 0.0))
    world.run_law(0.7, law)
    return {"way_m": float(np.mean(world.positions()[:, 0]))}


def simulate(values, seed):
    return {**collapse(values, seed), **slide(values, seed)}


def trial(case, truth, seed):
    parameters, results, runs = CASES[case]
    run = collapse if results == ["run_out_m"] else simulate
    measured = [run(truth, 1000000 + 1000 * seed + k) for k in range(REPEATS)]
    targets = [calibrate.Target(name, float(np.mean([m[name] for m in measured])),
                                float(np.std([m[name] for m in measured], ddof=1)) / REPEATS**0.5)
               for name in results]
    return calibrate.calibrate(run, parameters, targets, runs=runs, seed=10000 * seed)


def main(number, seed):
    failures = 0
    for case, (parameters, _, runs) in CASES.items():
        rng, held, width = np.random.default_rng(seed), dict.fromkeys([p.name for p in parameters],
                                                                      0), {p.name: [] for p in parameters}
        for k in range(number):
            truth = {p.name: calibrate._value(p, u) for p, u in zip(parameters, rng.uniform(size=len(parameters)))}
            found = trial(case, truth, seed + k)
            for p in parameters:
                held[p.name] += found.low[p.name] <= truth[p.name] <= found.high[p.name]
                ends = [np.log(v) if p.log else v for v in (found.low[p.name], found.high[p.name], p.low, p.high)]
                width[p.name].append((ends[1] - ends[0]) / (ends[3] - ends[2]))
            print(f"{case} {k + 1}: "
                  + ", ".join(f"{n} {truth[n]:.3g} in {found.low[n]:.3g} .. {found.high[n]:.3g}" for n in held),
                  flush=True)
        bad = [n for n in held if held[n] < 0.85 * number]
        failures += len(bad)
        print(f"{case}, {runs} runs: "
              + ", ".join(f"{n} held in {held[n]} of {number}, range {100 * np.mean(width[n]):.0f} % of the bounds"
                          for n in held) + (" !" if bad else ""), flush=True)
    return failures


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 20, int(sys.argv[2]) if len(sys.argv) > 2 else 1) > 0)
