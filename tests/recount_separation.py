#!/usr/bin/env python3
# Counts a separation anew from single particles: recount_separation.py FOLDER JSON SIEVES|- FINE COARSE|- CUT [FROM]
#   FOLDER/passed.csv has a line for each particle that left; with COARSE "-" the coarse product is all that has not
# left as fine: by another
#   exit, or still there, in the last of FOLDER/particles_*.csv. SIEVES: in mm with commas, "-": each size is its own
# class. FROM: what left
#   after that time [s] counts. Compares every number of separation.csv and the JSON.
import csv
import glob
import json
import math
import sys

folder, file, sieves, fine, coarse, cut = sys.argv[1:7]
begin = float(sys.argv[7]) if len(sys.argv) > 7 else -1.0
sieves = None if sieves == "-" else sorted(float(x) * 1e-3 for x in sieves.split(","))
cut = float(cut) * 1e-3
grains = []  # diameter, mass, goes to coarse
with open(folder + "/passed.csv", encoding="ascii") as lines:
    for row in csv.DictReader(lines):
        if float(row["time_s"]) > begin and (coarse == "-" or row["exit"] in (fine, coarse)):
            grains.append((float(row["diameter_m"]), float(row["mass_kg"]), row["exit"] != fine))
if coarse == "-":
    with open(max(glob.glob(folder + "/particles_*.csv")), encoding="ascii") as lines:
        next(lines)
        for row in csv.DictReader(lines):
            grains.append((float(row["diameter_m"]), float(row["mass_kg"]), True))


def class_of(d):
    if sieves is None:
        return (round(d, 12), round(d, 12))
    below = [s for s in sieves if s <= d * (1 + 1e-12)]
    above = [s for s in sieves if s > d * (1 + 1e-12)]
    return (below[-1] if below else 0.0, above[0] if above else math.inf)


classes = {}
for d, m, stays in grains:
    c = classes.setdefault(class_of(d), [0.0, 0.0, 0.0, 0])
    c[stays] += m
    c[2] += m * d
    c[3] += 1
curve = sorted((c[2] / (c[0] + c[1]), c[1] / (c[0] + c[1]), key, c) for key, c in classes.items())


def near(what, told, counted, tolerance=1e-9):
    if told is None or told == "":
        told = math.nan
    told = float(told)
    if math.isnan(told) and (counted is None or math.isnan(counted)):
        return
    if counted is None or not abs(told - counted) <= tolerance * max(abs(counted), 1e-12 if counted else 1.0):
        sys.exit(f"{what}: {told} is told, {counted} is counted")


with open(folder + "/separation.csv", encoding="ascii") as lines:
    rows = list(csv.DictReader(lines))
full = [row for row in rows if float(row["particles"]) > 0]
if len(full) != len(curve):
    sys.exit(f"{len(full)} classes are told, {len(curve)} are counted")
for row, (size, share, key, c) in zip(full, curve):
    near("low", row["low_m"], key[0])
    near("high", row["high_m"] or math.inf, key[1]) if key[1] < math.inf else None
    near("size", row["size_m"], size)
    near("share", row["to_coarse"], share)
    near("fine", row["fine_kg"], c[0], 1e-8)
    near("coarse", row["coarse_kg"], c[1], 1e-8)
    near("number", row["particles"], float(c[3]))
    if not float(row["low95"]) <= share <= float(row["high95"]):
        sys.exit("a share outside its own range")


def size_at(level):
    for (d0, t0, _, _), (d1, t1, _, _) in reversed(list(zip(curve, curve[1:]))):
        if t0 < level <= t1:
            return d0 + (d1 - d0) * (level - t0) / (t1 - t0)
    return None


results = {name: r["value"] for name, r in json.load(open(file, encoding="utf-8"))["results"].items()}
near("d50", results["d50_m"], size_at(0.5))
if size_at(0.25) and size_at(0.75) and all(a[1] <= b[1] for a, b in zip(curve, curve[1:])):
    near("Ep", results["probable_error_m"], 0.5 * (size_at(0.75) - size_at(0.25)))
under = [sum(m for d, m, stays in grains if d < cut and stays == s) for s in (False, True)]
over = [sum(m for d, m, stays in grains if d >= cut and stays == s) for s in (False, True)]
recovery = under[0] / sum(under) if sum(under) else None
loss = over[0] / sum(over) if sum(over) else None
near("recovery", results["recovery"], recovery, 1e-8)
near("efficiency", results["efficiency"], None if None in (recovery, loss) else recovery - loss, 1e-8)
near("yield", results["fine_yield"], (under[0] + over[0]) / (sum(under) + sum(over)), 1e-8)
print(f"{len(grains)} grains in {len(curve)} classes, d50 {results['d50_m']}: as told")
