# Bricks of benchmarks/dem_bricks in YADE: Polyhedra (overlap volume), run as
#   yade -n -x bricks.py STATE.csv SIDE STEPS DT
# Not periodic: its polyhedra know no periodic cell. Bricks at the sides stand free.
import csv, sys, time
from yade import O, polyhedra_utils, utils, Vector3, Quaternion

state, side, steps, dt = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])
a = 2e-3
material = PolyhedraMat()
material.density, material.young, material.poisson, material.frictionAngle = 2500.0, 1e8, 0.3, 0.4636
half = [Vector3(x * a / 2, y * a / 2, z * 2.08 * a / 2) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
with open(state) as file:
    rows = list(csv.DictReader(file))
for row in rows:
    q = Quaternion(*[float(row['q_' + k]) for k in 'wxyz'])
    x = Vector3(*[float(row[k + '_m']) for k in 'xyz'])
    O.bodies.append(polyhedra_utils.polyhedra(material, v=[x + q * p for p in half]))
O.bodies.append(utils.wall(0, axis=2, sense=1, material=material))
O.dt = dt
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Polyhedra_Aabb(), Bo1_Wall_Aabb()]),
    InteractionLoop([Ig2_Wall_Polyhedra_PolyhedraGeom(), Ig2_Polyhedra_Polyhedra_PolyhedraGeom()],
                    [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()], [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()]),
    NewtonIntegrator(damping=0.0, gravity=(0, 0, -9.81)),
]
O.run(1, True)
began = time.process_time()
O.run(steps, True)
cpu = time.process_time() - began
touching = sum(1 for i in O.interactions if i.isReal)
print('bricks: cpu_s %.6g contacts %d' % (cpu, touching))
