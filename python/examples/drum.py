"""Two sizes in a rotating drum: how mixed they are over time. Change: LARGE and SMALL (numbers), the sizes, SPIN."""
import matplotlib.pyplot as plt
import numpy as np

from riddle import dem, script

OPTIONS = script.options(__doc__)
QUICK = OPTIONS.quick
RADIUS, LENGTH, SPIN, LARGE, SMALL = 0.05, 0.02, 2 * np.pi * 0.5, (60 if QUICK else 300), (240 if QUICK else 1200)
LAW = dem.LINEAR | dem.FRICTION

definition = dem.def_(dt=2e-5)
definition.gravity = (0.0, -9.81, 0.0)
definition.periodic = [0, 0, 1]
definition.low, definition.high = (-0.1, -0.1, 0.0), (0.1, 0.1, LENGTH)
glass = dem.add_material(definition, 2500.0, 5e10, 0.2)
contact = dem.pair(definition, glass, glass)
contact.stiffness, contact.restitution, contact.friction = 2000.0, 0.6, 0.5

world = dem.World(definition)
drum = world.add_cylinder(glass, (0, 0, 0), (0, 0, 1), RADIUS, 1)
feed = dem.default_feed()
for group, (number, diameter, low) in enumerate([(SMALL, 2.5e-3, (-0.045, -0.02)), (LARGE, 4e-3, (0.0, -0.02))]):
    feed.region = dem.box_region((low[0], low[1], 0.0), (low[0] + 0.045, low[1] + 0.045, LENGTH))
    feed.sizes, feed.group = dem.one_size(diameter), group
    world.fill(feed, number)
world.run(0.3, LAW)
world.rotate(drum, (0, 0, 0), (0, 0, 1), SPIN)

cells = dem.cells(low=(-RADIUS, -RADIUS, 0.0), high=(RADIUS, RADIUS, LENGTH), n=[10, 10, 1])
times, lacey = [], []
for _ in range(5 if QUICK else 60):
    world.run(0.1, LAW)
    of_small = world.count_in_cells(cells, 0)
    mixing = dem.mixing_of(of_small.of_group.ravel(), of_small.of_all.ravel())
    times.append(world.time)
    lacey.append(mixing.lacey)
print(f"Lacey's index {lacey[0]:.2f} at the start, {lacey[-1]:.2f} at {world.time:.1f} s")

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4))
left.add_patch(plt.Circle((0, 0), 1e3 * RADIUS, fill=False))
world.draw(left, right=0, up=1)
left.set(xlabel="x [mm]", ylabel="y [mm]", title=f"{world.time:.1f} s")
right.plot(times, lacey)
right.set(xlabel="time [s]", ylabel="Lacey's index: 0 separated, 1 random", ylim=(0, 1.1))
figure.tight_layout()
script.save(figure, OPTIONS, "drum.png", dpi=130)
