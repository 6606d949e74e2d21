#!/usr/bin/env python3
"""How often the 95 % ranges of riddle.calibrate hold the parameters that synthetic results were made from: drawn within
their bounds, with noise of the simulation and of the measured values. Leaves with 1 where a range holds in less than 93
or more than 97 of 100 trials, apart from what so many trials leave open.
  tests/calibration_trials.py [TRIALS] [SEED] [MODEL]     trials of each model (500), or of one: line, idle, heap,
  three"""
import importlib.util
import math
import os
import sys

import numpy as np

python = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python")
sys.path.insert(0, python)
path = os.path.join(python, "riddle", "calibrate.py")
spec = importlib.util.spec_from_file_location("calibrate", path)
calibrate = sys.modules["calibrate"] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(calibrate)
P = calibrate.Parameter


def heap(v):
    return {"angle": 12.0 + 22.0 * v["mu"] / (v["mu"] + 0.25) + 5.3 * v["mu"] * math.log10(v["roll"] / 0.01),
            "density": 0.64 - 0.05 * v["mu"] - 0.03 * math.sqrt(v["roll"])}


def line(v):
    return {"rate": 3.0 - 1.7 * v["mu"]}


def idle(v):
    return {"rate": 0.2 + 0.3 * (1.0 - v["e"]) ** 2}


def three(v):
    return {"angle": 15.0 + 20.0 * math.tanh(2.0 * v["mu"]) + 8.0 * v["roll"],
            "rate": 0.25 * (1.0 - 0.3 * v["mu"]) * (1.0 - 0.2 * v["roll"]),
            "torque": 1.0 + v["mu"] ** 2 + 0.6 * math.exp(-3.0 * v["e"])}


def rates(v):
    """Mean size and share of the fines of a granulator after three times (python/examples/granulation_rates.py)."""
    from riddle import granulation
    start, edges = 1e-12, np.geomspace(1e-14, 1e-9, 41)
    cells = 0.5 * (edges[1:] + edges[:-1])
    diameters = np.cbrt(6.0 / np.pi * cells)
    balance = granulation.Balance(granulation.balance_def(
        kernel=granulation.constant_kernel, kernel_user=granulation.kernel_data(rate=v["coalescence"]),
        selection=lambda granule, user: v["breakage"], daughters=granulation.UNIFORM), edges, None)
    balance.add(granulation.granule(s=0.7 * start, l=0.3 * start), 1.0)
    results, before = {}, 0.0
    for time in (30.0, 60.0, 120.0):
        balance.run(time - before)
        before = time
        volumes = np.array([balance.number(k) for k in range(len(cells))]) * cells
        results[f"d43_{time:.0f}"] = 1e6 * np.sum(volumes * diameters) / np.sum(volumes)
        results[f"fines_{time:.0f}"] = np.sum(volumes[diameters < 120e-6]) / np.sum(volumes)
    return results


# a model, its parameters, the noise of a run and the error of a measured value, runs
MODELS = [(line, [P("mu", 0.1, 0.9)], {"rate": (0.03, 0.05)}, 14),
          (idle, [P("e", 0.2, 0.95), P("idle", 0.0, 1.0)], {"rate": (0.004, 0.004)}, 24),
          (heap, [P("mu", 0.1, 0.9), P("roll", 0.01, 0.5, True)], {"angle": (0.6, 0.8), "density": (0.002, 0.002)}, 30),
          (three, [P("mu", 0.1, 0.9), P("roll", 0.0, 1.0), P("e", 0.1, 0.9)],
           {"angle": (0.5, 0.7), "rate": (0.002, 0.002), "torque": (0.02, 0.03)}, 40),
          (rates, [P("coalescence", 1e-3, 3e-2, True), P("breakage", 1e-4, 2e-2, True)],
           {f"{name}_{time}": (0.0, error) for time in (30, 60, 120) for name, error in (("d43", 1.0), ("fines", 0.01))},
           30)]


def trials(number, seed, only=None):
    failures = 0
    for model, parameters, errors, runs in MODELS:
        if only not in (None, model.__name__):
            continue
        rng = np.random.default_rng(seed)
        held = dict.fromkeys([p.name for p in parameters], 0)
        for k in range(number):
            truth = {p.name: calibrate._value(p, u) for p, u in zip(parameters, rng.uniform(size=len(parameters)))}
            targets = [calibrate.Target(name, value + errors[name][1] * rng.normal(), errors[name][1])
                       for name, value in model(truth).items()]
            noise = np.random.default_rng((seed, k))
            found = calibrate.calibrate(lambda v, s: {name: value + errors[name][0] * noise.normal()
                                                      for name, value in model(v).items()},
                                        parameters, targets, runs=runs, seed=k)
            for name in held:
                held[name] += found.low[name] <= truth[name] <= found.high[name]
            if k % 20 == 19:
                print(f"  {model.__name__}, {k + 1} of {number}: "
                      + ", ".join(f"{name} {n}" for name, n in held.items()), file=sys.stderr, flush=True)
        open_ = 3.0 * math.sqrt(0.05 * 0.95 / number)
        bad = [name for name in held if not 0.93 - open_ <= held[name] / number <= 0.97 + open_]
        failures += len(bad)
        print(f"{model.__name__:6} {runs} runs: "
              + ", ".join(f"{name} {100.0 * n / number:.1f} %" for name, n in held.items())
              + (" !" if bad else ""), flush=True)
    return failures


if __name__ == "__main__":
    sys.exit(trials(int(sys.argv[1]) if len(sys.argv) > 1 else 500, int(sys.argv[2]) if len(sys.argv) > 2 else 1,
                    sys.argv[3] if len(sys.argv) > 3 else None) > 0)
