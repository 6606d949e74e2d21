# Touching pairs of polyhedra as in benchmarks/dem_rocks, in YADE: Polyhedra (overlap volume), run as
#   yade -n -x rocks.py CSV CORNERS...
# Grains of 5 mm (diameter of the volume), ratios of axes 0.8 and 0.75, turned at random; a pair overlaps by 1e-4 of its
# diameter. Writes corners, contacts of 64 pairs, processor time of a pair and step.
import math
import random
import sys
import time

from yade import O, polyhedra_utils, utils, Matrix3, Quaternion, Vector3

PAIRS, SIZE, STEPS = 64, 5e-3, 50
material = PolyhedraMat()
material.density, material.young, material.poisson, material.frictionAngle = 2600.0, 1e7, 0.3, 0.4636


def random_turn():
    while True:
        q = [random.uniform(-1, 1) for _ in range(4)]
        n = sum(x * x for x in q)
        if 0.01 < n < 1:
            return Quaternion(*[x / math.sqrt(n) for x in q])


def grain(corners):
    """Corners of a grain: random points of an ellipsoid."""
    points = []
    for _ in range(corners):
        p = Vector3(random.gauss(0, 1), random.gauss(0, 1), random.gauss(0, 1)).normalized()
        points.append(Vector3(p[0] / 0.8, p[1], 0.75 * p[2]) * 0.5 * SIZE)
    turn = random_turn()
    return [turn * p for p in points]


def time_pairs(corners):
    O.reset()
    O.dt = 1e-12
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Polyhedra_Aabb()], verletDist=0),
        InteractionLoop([Ig2_Polyhedra_Polyhedra_PolyhedraGeom()], [Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()],
                        [Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()]),
        NewtonIntegrator(damping=0.0),
    ]
    pairs = []
    for k in range(PAIRS):
        at = Vector3(10 * SIZE * (k % 8), 10 * SIZE * (k // 8), 0)
        a = O.bodies.append(polyhedra_utils.polyhedra(material, v=grain(corners)))
        b = O.bodies.append(polyhedra_utils.polyhedra(material, v=grain(corners)))
        O.bodies[a].state.pos = at
        pairs.append([a, b, at, 0.3 * SIZE, 1.5 * SIZE])

    def place(distance):
        for pair in pairs:
            O.bodies[pair[1]].state.pos = pair[2] + Vector3(distance(pair), 0, 0)
            for i in pair[:2]:
                O.bodies[i].state.vel = O.bodies[i].state.angVel = Vector3.Zero
        O.interactions.clear()
        O.run(1, True)

    for _ in range(14):  # how far apart two touch
        place(lambda pair: 0.5 * (pair[3] + pair[4]))
        touching = {i.id1 for i in O.interactions if i.isReal}
        for pair in pairs:
            pair[3 if pair[0] in touching else 4] = 0.5 * (pair[3] + pair[4])
    place(lambda pair: pair[3] - 1e-4 * SIZE)
    contacts = sum(1 for i in O.interactions if i.isReal)
    began = time.process_time()
    O.run(STEPS, True)
    return contacts, (time.process_time() - began) / (PAIRS * STEPS)


random.seed(1)
with open(sys.argv[1], 'w') as file:
    file.write('corners,contacts,step_s\n')
    for corners in [int(n) for n in sys.argv[2:]]:
        file.write('%d,%d,%.6g\n' % ((corners,) + time_pairs(corners)))
        file.flush()
