"""A batch of wet granules: growth of the mean size for two binder contents. Change: the nucleus, STEPS."""
import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt

from riddle import granulation, script

OPTIONS = script.options(__doc__)
STEPS, EVERY = (100 if OPTIONS.quick else 1000), 10
figure, axes = plt.subplots(figsize=(6, 4))
for liquid in (0.25e-12, 0.33e-12):
    definition = granulation.def_(seed=1)
    sim = granulation.sim_init(definition)
    nucleus = granulation.granule(s=0.52e-12, l=liquid, a=0.15e-12)
    granulation.sim_add(sim, nucleus, 200)
    times, sizes = [0.0], [1e6 * granulation.sim_mean(sim, 4, 3)]
    for _ in range(STEPS // EVERY):
        granulation.sim_run(sim, EVERY)
        times.append(times[-1] + EVERY * definition.step)
        sizes.append(1e6 * granulation.sim_mean(sim, 4, 3))
    axes.plot(times, sizes, label=f"liquid over solid {liquid / 0.52e-12:.2f}")
    print(f"liquid over solid {liquid / 0.52e-12:.2f}: d43 {sizes[0]:.0f} -> {sizes[-1]:.0f} um")
axes.set(xlabel="time [s]", ylabel="volume mean diameter d43 [um]", title="growth of wet granules")
axes.legend()
figure.tight_layout()
script.save(figure, OPTIONS, "granulation.png", dpi=130)
