"""Separation curves of a deflector wheel at three speeds. Change: the material, the speeds."""
import matplotlib.pyplot as plt
import numpy as np

from riddle import classifier, script

OPTIONS = script.options(__doc__)
figure, axes = plt.subplots(figsize=(6, 4))
for rpm in (3000.0, 9000.0, 15000.0):
    definition = classifier.paper_def(classifier.LIMESTONE, rpm).value
    model = classifier.Model(definition)
    median = model.quantile(0.5)
    x = np.geomspace(0.3 * median, 3.0 * median, 60)
    curve = model.separate(x)
    axes.semilogx(1e6 * x, curve.t, label=f"{rpm:.0f} rpm, x50 = {1e6 * curve.result.x50:.1f} µm")
    print(f"{rpm:.0f} rpm: x50 {1e6 * curve.result.x50:.2f} µm")
axes.set(xlabel="size [µm]", ylabel="share rejected to the coarse product [-]", title="deflector wheel, limestone")
axes.legend()
figure.tight_layout()
script.save(figure, OPTIONS, "classifier.png", dpi=130)
