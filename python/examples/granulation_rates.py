"""Rates of coalescence and breakage from sizes measured at several times. Change: HISTORY, the kernel, the breakage
function."""
import matplotlib.pyplot as plt
import numpy as np

from riddle import calibrate, granulation, script

OPTIONS = script.options(__doc__)
RUNS = 14 if OPTIONS.quick else 30
START, EDGES = 1e-12, np.geomspace(1e-14, 1e-9, 41)  # volume of a nucleus, edges of cells [m3]
CELLS = 0.5 * (EDGES[1:] + EDGES[:-1])
DIAMETERS = np.cbrt(6.0 / np.pi * CELLS)
TIMES = (30.0, 60.0, 120.0)  # [s]
# Mean diameter d43 and share of the volume below 120 µm, with standard errors: made from coalescence 0.01 and breakage
# 0.004, with noise.
HISTORY = {"d43_30": (132.3, 1.0), "d43_60": (137.2, 1.0), "d43_120": (148.9, 1.0), "fines_30": (0.418, 0.01),
           "fines_60": (0.340, 0.01), "fines_120": (0.257, 0.01)}


def simulate(values, seed):
    """Granules that meet by their volumes, and break into fragments as large as each other."""
    definition = granulation.balance_def(kernel=granulation.constant_kernel,
                                         kernel_user=granulation.kernel_data(rate=values["coalescence"]),
                                         selection=lambda granule, user: values["breakage"],
                                         daughters=granulation.UNIFORM)
    balance = granulation.Balance(definition, EDGES, None)
    balance.add(granulation.granule(s=0.7 * START, l=0.3 * START), 1.0)
    results, before = {}, 0.0
    for time in TIMES:
        balance.run(time - before)
        before = time
        volumes = np.array([balance.number(k) for k in range(len(CELLS))]) * CELLS
        results[f"d43_{time:.0f}"] = 1e6 * np.sum(volumes * DIAMETERS) / np.sum(volumes)
        results[f"fines_{time:.0f}"] = np.sum(volumes[DIAMETERS < 120e-6]) / np.sum(volumes)
    return results


parameters = [calibrate.Parameter("coalescence", 1e-3, 3e-2, True), calibrate.Parameter("breakage", 1e-4, 2e-2, True)]
targets = [calibrate.Target(name, *value) for name, value in HISTORY.items()]
found = calibrate.calibrate(simulate, parameters, targets, runs=RUNS)
print(found)
figure, axes = plt.subplots(figsize=(6, 4))
axes.loglog(found.points[:, 0], found.points[:, 1], ".", markersize=2)
axes.set(xlabel="coalescence [1/s]", ylabel="breakage [1/s]", title="rates that the measured sizes leave",
         xlim=(1e-3, 3e-2), ylim=(1e-4, 2e-2))
figure.tight_layout()
script.save(figure, OPTIONS, "granulation_rates.png", dpi=130)
