"""A batch of wet granules: growth of the mean size for two binder contents. Change: the nucleus, STEPS."""
import matplotlib.pyplot as plt

from riddle import granulation, script

OPTIONS = script.options(__doc__)
STEPS, EVERY = (100 if OPTIONS.quick else 1000), 10
figure, axes = plt.subplots(figsize=(6, 4))
for liquid in (0.25e-12, 0.33e-12):
    definition = granulation.def_(seed=1)
    sim = granulation.Sim(definition)
    nucleus = granulation.granule(s=0.52e-12, l=liquid, a=0.15e-12)
    sim.add(nucleus, 200)
    times, sizes = [0.0], [1e6 * sim.mean(4, 3)]
    for _ in range(STEPS // EVERY):
        sim.run(EVERY)
        times.append(times[-1] + EVERY * definition.step)
        sizes.append(1e6 * sim.mean(4, 3))
    axes.plot(times, sizes, label=f"liquid over solid {liquid / 0.52e-12:.2f}")
    print(f"liquid over solid {liquid / 0.52e-12:.2f}: d43 {sizes[0]:.0f} -> {sizes[-1]:.0f} µm")
axes.set(xlabel="time [s]", ylabel="volume mean diameter d43 [µm]", title="growth of wet granules")
axes.legend()
figure.tight_layout()
script.save(figure, OPTIONS, "granulation.png", dpi=130)
