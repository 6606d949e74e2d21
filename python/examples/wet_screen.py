"""A moist batch on a vibrated wire screen: fractions retained. Change: the classes, APERTURE, MOISTURE."""
import os
import subprocess
import tempfile

import matplotlib.pyplot as plt
import numpy as np

from riddle import dem, script

OPTIONS = script.options(__doc__)
QUICK = OPTIONS.quick
MOISTURE, APERTURE, WIRE, RADIUS, DURATION = 0.025, 8e-3, 2e-3, 0.05, (0.3 if QUICK else 5.0)
CLASSES = [(5e-3, 150), (7e-3, 60), (10e-3, 60)]  # diameter [m], number

root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
with tempfile.TemporaryDirectory() as folder:
    library = os.path.join(folder, "wet.so")
    subprocess.run([os.environ.get("CC", "cc"), "-O2", "-ffp-contract=off", "-fPIC", "-shared", "-I", root,
                    os.path.join(root, "python/laws/wet.c"), "-lm", "-o", library], check=True)
    wet = dem.Law(library)

definition = dem.def_(dt=1e-5)
glass, steel = dem.add_material(definition, 2534.1, 5e10, 0.2), dem.add_material(definition, 7850.0, 2e11, 0.3)
for other in (glass, steel):
    contact = dem.pair(definition, glass, other)
    contact.stiffness, contact.restitution, contact.friction = 2e4, 0.7, 0.3
world = dem.World(definition)
screen = dem.default_screen()
screen.aperture, screen.wire, screen.half_x, screen.half_y = APERTURE, WIRE, RADIUS, RADIUS
deck = world.add_screen(steel, screen)
world.add_cylinder(steel, (0, 0, 0), (0, 0, 1), RADIUS, 1)
world.add_exit((0, 0, -0.05), (0, 0, 1))
feed = dem.default_feed()
feed.region = dem.cylinder_region((0, 0, 0.01), (0, 0, 1), 0.15, 0.95 * RADIUS)
for group, (diameter, number) in enumerate(CLASSES):
    feed.sizes, feed.group = dem.one_size(diameter), group
    world.fill(feed, number)
world.vibrate(deck, (1e-4, 0, 9e-4), (0, 0, np.pi / 2), 50.6)
wet.set("moisture", MOISTURE)
wet.set("deck", deck)

groups = np.array(world.groups())
start = np.bincount(groups, minlength=3)
times, retained = [], []
while world.time < DURATION:
    world.run_law(0.05, wet)
    above = world.present() & (world.positions()[:, 2] > 0.0)
    times.append(world.time)
    retained.append(np.bincount(world.groups()[above], minlength=3) / start)
print(f"{int(wet.get('bridges'))} bridges; retained after {world.time:.2f} s:", np.round(retained[-1], 3))
figure, axes = plt.subplots(figsize=(6, 4))
for group, (diameter, _) in enumerate(CLASSES):
    axes.plot(times, np.array(retained)[:, group], label=f"{1e3 * diameter:.0f} mm")
axes.set(xlabel="time [s]", ylabel="fraction retained [-]", title=f"{100 * MOISTURE:.1f} % of water", ylim=(0, 1.05))
axes.legend()
figure.tight_layout()
script.save(figure, OPTIONS, "wet_screen.png", dpi=130)
