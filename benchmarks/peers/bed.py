# The beds of benchmarks/README.md in YADE: run as
#   yade -n -x bed.py START.csv COPIES LENGTH STEPS AMPLITUDE FRICTION [VOLUME]
# COPIES of the start stand beside each other along x; LENGTH is the side of one [m]; AMPLITUDE of the floor [m], 0: at
# rest; FRICTION 0 or 1; VOLUME of the water bridge that each contact makes [m3]: Willett's full fit, no viscosity,
# contact angle 15 degrees. The floor of facets is at A (1 - cos(2 pi f t)), f = 50.6 Hz: an infinite wall in a periodic
# cell does not work. A free surface: the cell is periodic in z, too, but much higher than the bed.
import csv, sys, time
from math import pi, sin
from yade import O, utils
from yade import Vector3, Matrix3

start, copies, length, steps = sys.argv[1], int(sys.argv[2]), float(sys.argv[3]), int(sys.argv[4])
amplitude, friction = float(sys.argv[5]), int(sys.argv[6])
volume = float(sys.argv[7]) if len(sys.argv) > 7 else 0.0
radius, density, height, base = 0.0025, 2534.0, 0.5, 0.05   # base: height of the floor in the cell
mass = density * 4.0 / 3.0 * pi * radius**3

# Parameters of two touching bodies act in series: 1/k = 1/k_a + 1/k_b. Wanted: k_n 1e5, k_t 2/7 k_n, damping m/2 x
# 5475.7 between spheres and m x 3871.9 with the floor. (YADE's dashpot never pulls; LAMMPS's does.)
kn, ks = 2.0e5, friction * 2.0e5 * 2.0 / 7.0
c_sphere = mass * 5475.7
c_floor = mass / (1.0 / 3871.9 - 1.0 / 5475.7)
angle = friction * 0.19739555984988078                       # atan(0.2)
liquid = dict(Capillar=True, CapillarType='Willett_numeric', Vb=volume, gamma=0.07275, theta=15.0) if volume > 0 else {}
material = ViscElCapMat if volume > 0 else ViscElMat
glass = O.materials.append(material(kn=kn, ks=ks, cn=c_sphere, cs=0.0, density=density, frictionAngle=angle, **liquid))
ground = O.materials.append(material(kn=kn, ks=ks, cn=c_floor, cs=0.0, density=density, frictionAngle=angle, **liquid))
law = ([Ip2_ViscElCapMat_ViscElCapMat_ViscElCapPhys()], [Law2_ScGeom_ViscElCapPhys_Basic()]) if volume > 0 else \
      ([Ip2_ViscElMat_ViscElMat_ViscElPhys()], [Law2_ScGeom_ViscElPhys_Basic()])

O.periodic = True
O.cell.hSize = Matrix3(copies * length, 0, 0, 0, length, 0, 0, 0, height)
spheres = []
with open(start) as file:
    rows = [[float(x) for x in row] for row in csv.reader(file) if row and not row[0].startswith(('#', 'x'))]
for c in range(copies):
    for x, y, z, vx, vy, vz, wx, wy, wz in rows:
        body = utils.sphere((x + c * length, y, z + base), radius, material=glass)
        body.state.vel, body.state.angVel = (vx, vy, vz), (wx, wy, wz)
        spheres.append(O.bodies.append(body))

floor, tiles = [], (4 * copies, 4)                           # small facets: few spheres near each
dx, dy = copies * length / tiles[0], length / tiles[1]
for i in range(tiles[0]):
    for j in range(tiles[1]):
        a, b, c, d = [((i + p) * dx, (j + q) * dy, base) for p, q in ((0, 0), (1, 0), (1, 1), (0, 1))]
        for corners in ((a, b, c), (a, c, d)):
            floor.append(O.bodies.append(utils.facet(corners, fixed=True, material=ground)))

def shake():
    omega = 2 * pi * 50.6
    speed = Vector3(0, 0, amplitude * omega * sin(omega * (O.time + 0.5 * O.dt)))
    for k in floor:
        O.bodies[k].state.vel = speed

O.dt = 4.0e-6
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb()], verletDist=0.1 * radius, allowBiggerThanPeriod=True),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom()], *law),
]
if amplitude > 0:
    O.engines += [PyRunner(command='shake()', iterPeriod=1)]
O.engines += [NewtonIntegrator(damping=0, gravity=(0, 0, -9.81))]

O.run(1, True)                                               # builds the first lists
began = time.process_time()
O.run(steps - 1, True)
cpu = (time.process_time() - began) * steps / max(steps - 1, 1)
z = sum(O.bodies[k].state.pos[2] for k in spheres) / len(spheres) - base
energy = sum(0.5 * mass * O.bodies[k].state.vel.squaredNorm() for k in spheres)
print('bed: cpu_s %.6g mean_height %.17g kinetic_energy %.17g' % (cpu, z, energy))
