"""Discharge of a hopper: rate of outflow, and a picture of the grains inside. Change: ORIFICE, SPHERES, the cone."""
import matplotlib.pyplot as plt
import numpy as np

from riddle import dem, script

OPTIONS = script.options(__doc__)
SPHERES, DIAMETER, ORIFICE, RADIUS, SLOPE = (300 if OPTIONS.quick else 2000), 5e-3, 0.03, 0.06, 1.0
LAW = dem.LINEAR | dem.FRICTION

definition = dem.def_(dt=2e-5)
glass = dem.add_material(definition, 2500.0, 5e10, 0.2)
contact = dem.pair(definition, glass, glass)
contact.stiffness, contact.restitution, contact.friction = 2000.0, 0.5, 0.5

world = dem.World(definition)
height = SLOPE * (RADIUS - ORIFICE / 2)
world.add_cylinder(glass, (0, 0, 0), (0, 0, 1), RADIUS, 1)
funnel = dem.default_cone()
funnel.low, funnel.high, funnel.low_radius, funnel.high_radius = (0, 0, 0), (0, 0, height), ORIFICE / 2, RADIUS
world.add_cone(glass, funnel)
lid = world.add_plane(glass, (0, 0, 0), (0, 0, 1))
world.add_exit((0, 0, -0.05), (0, 0, 1))

feed = dem.default_feed()
feed.region = dem.cylinder_region((0, 0, height), (0, 0, 1), 0.25, RADIUS)
feed.sizes = dem.uniform_sizes(0.9 * DIAMETER, 1.1 * DIAMETER, 0)
world.fill(feed, SPHERES)
world.run(0.5, LAW)
full = world.picture(direction=(0.25, 1.0, -0.35))

world.enable_wall(lid, 0)
times, passed = [], []
opened = world.time
while world.passed_count < 0.8 * SPHERES and world.time - opened < 5.0:
    world.run(0.02, LAW)
    times.append(world.time - opened)
    passed.append(world.passed_count)
rate = np.polyfit(times, passed, 1)[0] * np.mean(world.masses())
print(f"{world.passed_count} of {SPHERES} spheres in {times[-1]:.2f} s, {1e3 * rate:.1f} g/s")

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4))
left.imshow(full.pixels)
left.set(title="before opening")
left.axis("off")
right.plot(times, passed)
right.set(xlabel="time since opening [s]", ylabel="spheres that have left", title=f"{1e3 * rate:.1f} g/s")
figure.tight_layout()
script.save(figure, OPTIONS, "hopper.png", dpi=130)
