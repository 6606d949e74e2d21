#!/usr/bin/env python3
"""Writes two_spheres.csv: creeping flow between two spheres that approach each other along their line of centres with
equal and opposite forces, and a sphere that approaches a wall. Stream function in bispherical coordinates (Stimson and
Jeffery 1926; Maude 1961), a system of four equations for each term; equal spheres and the wall by Brenner's (1961)
series, which the first one must meet.

gap: over the radius of the first sphere, the smaller one. speed: of the first sphere, over the speed of approach.
force: on either, over 6 pi mu (radius of the first) (speed of approach)."""
import math
import os


def brenner(alpha, wall):
    """Force over Stokes's, of a sphere towards a wall or a mirror; cosh(alpha): distance of the centre over the
    radius."""
    total = 0.0
    for n in range(1, 100000):
        m = 2 * n + 1
        if m * alpha > 700:
            break
        if wall:
            term = (2 * math.sinh(m * alpha)
                    + m * math.sinh(2 * alpha)) / (4 * math.sinh(m * alpha / 2) ** 2 - (m * math.sinh(alpha)) ** 2) - 1
        else:
            term = (4 * math.cosh(m * alpha / 2) ** 2
                    + (m * math.sinh(alpha)) ** 2) / (2 * math.sinh(m * alpha) - m * math.sinh(2 * alpha)) - 1
        total += n * (n + 1) / ((2 * n - 1) * (2 * n + 3)) * term
    return 4 / 3 * math.sinh(alpha) * total


def solved(rows, right):
    rows = [row + [value] for row, value in zip(rows, right)]
    for i in range(4):
        pivot = max(range(i, 4), key=lambda k: abs(rows[k][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for k in range(i + 1, 4):
            share = rows[k][i] / rows[i][i]
            rows[k] = [a - share * b for a, b in zip(rows[k], rows[i])]
    x = [0.0] * 4
    for i in (3, 2, 1, 0):
        x[i] = (rows[i][4] - sum(rows[i][c] * x[c] for c in range(i + 1, 4))) / rows[i][i]
    return x


def sums(r1, r2, gap, u1, u2):
    """Sums of the series for both spheres, times their distance of poles; forces but for a common factor."""
    d = r1 + r2 + gap
    z1 = (d * d + r1 * r1 - r2 * r2) / (2 * d)
    c, a, b = math.sqrt(z1 * z1 - r1 * r1), math.acosh(z1 / r1), math.acosh((d - z1) / r2)
    first = second = 0.0
    for n in range(1, 5000):
        p, q, k = n - 0.5, n + 1.5, n * (n + 1) / (math.sqrt(2) * (2 * n - 1) * (2 * n + 1) * (2 * n + 3))
        rows, right = [], []
        for x, u in ((a, u1), (-b, u2)):
            high, low = [math.exp(-w * (a - x)) for w in (p, q)], [math.exp(-w * (b + x)) for w in (p, q)]
            near_p, near_q = math.exp(-p * abs(x)), math.exp(-q * abs(x))
            rows.append([high[0], low[0], high[1], low[1]])
            rows.append([p * high[0], -p * low[0], q * high[1], -q * low[1]])
            right += [-u * k * ((2 * n + 3) * near_p - (2 * n - 1) * near_q),
                      math.copysign(0.5, x) * u * k * (2 * n - 1) * (2 * n + 3) * (near_p - near_q)]
        s = solved(rows, right)
        first += 2 * (2 * n + 1) * (s[0] * math.exp(-p * a) + s[2] * math.exp(-q * a))
        second += 2 * (2 * n + 1) * (s[1] * math.exp(-p * b) + s[3] * math.exp(-q * b))
        if n * min(a, b) > 30:
            break
    return first * c, second * c


def stokes():
    """The common factor, from two equal spheres far from each other."""
    return brenner(math.acosh(1 + 0.5), False) / sums(1, 1, 1, -1, 1)[0]


def approach(ratio, gap):
    """Speed and force for radii 1 and ratio, such that the forces are equal and opposite."""
    alone, other = sums(1, ratio, gap, -1, 0), sums(1, ratio, gap, 0, 1)
    f1, both = (alone[0], other[0]), (alone[0] + alone[1], other[0] + other[1])
    s = both[1] / (both[1] - both[0])
    return s, s * f1[0] + (1 - s) * f1[1]


factor = stokes()
for gap in (0.01, 0.1, 1.0, 3.0):  # equal spheres: the first series meets the second one
    speed, force = approach(1, gap)
    assert abs(speed - 0.5) < 1e-9 and abs(force * factor / (0.5 * brenner(math.acosh(1 + gap / 2), False)) - 1) < 1e-9
with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "two_spheres.csv"), "w", encoding="utf-8") as file:
    file.write("# two_spheres.py\nradius_ratio,gap,speed,force\n")
    gaps = [0.00625, 0.0125, 0.025, 0.0375, 0.05, 0.0625, 0.075, 0.1, 0.125, 0.15, 0.175, 0.2, 0.225, 0.25, 0.3, 0.4,
            0.5, 0.75, 1.0]
    for ratio in (1, 2, 4):
        for gap in gaps:
            speed, force = approach(ratio, gap)
            file.write(f"{ratio},{gap},{speed:.8f},{force * factor:.8f}\n")
    for gap in gaps:
        file.write(f"inf,{gap},1,{brenner(math.acosh(1 + gap), True):.8f}\n")
