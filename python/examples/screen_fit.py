"""Fits a screening model to measured curves of a CSV: case, class, time, retained. Change: the file, FITTED, MODEL.

The shipped file has 27 simulated cases; three dry ones with amplitudes of 1 mm and more are fitted, another one is
predicted. Screening begins 0.5 s after the vibration: the bed has to reach the deck."""
import os

import matplotlib.pyplot as plt
import numpy as np

from riddle import screen, script

OPTIONS = script.options(__doc__)
MODEL, FITTED, SHOWN, BEGIN = screen.SOLDINGER, (5, 7, 9), (7, 8), 0.5
root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
with open(os.path.join(root, "data", "screening_27_cases.csv"), encoding="utf-8") as file:
    table = np.genfromtxt((line for line in file if not line.startswith("#")), delimiter=",", names=True)


def case_of(number):
    """Mean curves over the seeds of a case."""
    rows = table[(table["case"] == number) & (table["time_s"] >= BEGIN)]
    time = np.unique(rows["time_s"])
    curves = np.array([[rows[name][rows["time_s"] == t].mean() for t in time]
                       for name in ("retained_small", "retained_near_mesh")])
    curves = np.minimum.accumulate(np.clip(curves, 0.0, 1.0), axis=1)
    operation = screen.operation(amplitude=rows["amplitude_m"][0], frequency=rows["frequency_hz"][0],
                                 moisture=rows["moisture"][0])
    return screen.case(operation=operation, time=time - BEGIN, retained=curves)


definition = screen.def_(diameters=[5e-3, 7e-3], shares=[0.5, 0.5])
fit = screen.fit(definition, MODEL, [case_of(n) for n in FITTED], screen.default_fit_options(MODEL))
print(fit)
print(f"mean deviation {fit.deviation:.4f}")

figure, axes = plt.subplots(1, 2, figsize=(9, 4), sharey=True)
for ax, number in zip(axes, SHOWN):
    case = case_of(number)
    times = np.linspace(0.0, 20.0, 200)
    curves = screen.predict(definition, MODEL, fit.parameter, case.operation, times).retained
    for k, (label, colour) in enumerate((("5 mm", "tab:blue"), ("7 mm", "tab:orange"))):
        ax.plot(case.time, case.retained[k], ".", color=colour)
        ax.plot(times, curves[k], color=colour, label=label)
    ax.set(xlabel="time [s]", title=f"case {number}: {'fitted' if number in FITTED else 'predicted'}")
axes[0].set_ylabel("fraction retained [-]")
axes[0].legend()
figure.tight_layout()
script.save(figure, OPTIONS, "screen_fit.png", dpi=130)
