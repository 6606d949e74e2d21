"""What the texts say of the results of scripts/numbers: a function for each group of docs/numbers.ini. It gets r, the
JSON object that the command wrote, csv(name), the rows of a CSV that it wrote, and json(name), and returns the texts by
the names of their marks."""

import math
import statistics


def table(rows, columns):
    """A Markdown table. columns: (title, key or function of a row, format)."""
    lines = ["| " + " | ".join(title for title, _, _ in columns) + " |", "|" + "---|" * len(columns)]
    for row in rows:
        cells = []
        for _, key, form in columns:
            value = key(row) if callable(key) else row[key]
            cells.append(format(value, form) if form else str(value))
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def host_cost(r, csv, json):
    return {
        "rows": table(csv("cost.csv"), [("code", "code", ""), ("processor time [s]", "time_s", ".2f"),
                ("particle-steps per second", "particle_steps_per_s", ".3g")]),
        **{name: f"{1e9 * (csv('cost.csv')[k]['time_s'] - csv('cost.csv')[k - 1]['time_s']) / (5000 * 5600):.0f}"
           for name, k in (("lammps_bridge_ns", 2), ("dem_bridge_ns", 4))},
    }


def host_compare(r, csv, json):
    return {
        "rows": table(csv("compare.csv"), [("scene", "scene", ""),
                ("code", lambda x: {"dem": "dem.h", 1.0: "LAMMPS, one rank", 2.0: "LAMMPS, two ranks"}[x["code"]],
                    ""),
                ("bridges", lambda x: f"{x['bridges']:.0f} +- {x['bridges_ci']:.0f}", ""),
                ("mean height [mm]", lambda x: f"{1e3 * x['height_m']:.3f} +- {1e3 * x['height_ci_m']:.3f}", ""),
                ("kinetic energy [mJ]",
                    lambda x: f"{1e3 * x['kinetic_energy_J']:.4g} +- {1e3 * x['kinetic_energy_ci_J']:.2g}", "")]),
    }


def beds(r, csv, json):
    rows = csv("compare.csv")

    def ratio(code, spheres, scene, friction):
        wanted = {"code": code, "spheres": spheres, "scene": scene, "friction": friction}
        return next(x["ratio"] for x in rows if all(x[key] == value for key, value in wanted.items()))

    def bed(x):
        place = {"vibrated": "vibrated", "static": "at rest"}[x["scene"]]
        return f"{x['spheres']:.0f} spheres, {place}" + ("" if x["friction"] else ", no friction")

    codes = {"Riddle, the project's flags": "Riddle", "plain `cc -O2`": "Riddle -O2",
        "built for x86-64-v3": "Riddle x86-64-v3", "YADE": "YADE"}
    columns = [(title, lambda x, code=code: ratio(code, x["spheres"], x["scene"], x["friction"]), ".2f")
        for title, code in codes.items()]
    return {
        "rows": table([x for x in rows if x["code"] == "Riddle"], [("bed", bed, ""), *columns]),
        "vibrated": f"{ratio('Riddle', 20000, 'vibrated', 1):.1f}",
        "static": f"{ratio('Riddle', 20000, 'static', 1):.1f}",
    }


def compile_time(r, csv, json):
    return {
        "rows": table(csv("compile.csv"), [("program",
                    lambda x: {"include": "only includes dem.h", "manual": "the manual's program"}[x["program"]],
                    ""),
                ("compiler, -O2", "compiler", ""), ("processor time [s]", "processor_s", ".2f"),
                ("code [kB]", "code_kB", ".0f")]),
    }


def lines(r, csv, json):
    return {
        "rows": table(csv("lines.csv"), [("part", "part", ""), ("files", "files", ".0f"), ("lines", "lines", ".0f"),
                ("comments", "comments", ".0f")]),
    }


def demo(r, csv, json):
    return {
        "small": f"{r['retained_small'][-1]:.3f}",
        "near": f"{r['retained_near_mesh'][-1]:.3f}",
    }


def hopper(r, csv, json):
    return {
        "rows": table(r["runs"],
            [("D [mm]", lambda x: 1e3 * x["orifice_m"], ".3g"), ("fill [mm]", lambda x: 1e3 * x["height_m"], ".0f"),
                ("spheres", "spheres", ""), ("rate [kg/s]", "rate_kg_s", ".4f"),
                ("standard error", "standard_error_kg_s", ".4f")]),
        "exponent": f"{r['beverloo_exponent']:.2f}",
        "exponent_error": f"{r['standard_error_of_exponent']:.2f}",
        "k": f"{r['beverloo_k_of_exponent_2_5']:.2f}",
        "k_error": f"{r['standard_error_of_k_of_exponent_2_5']:.2f}",
        "c": f"{r['beverloo_C_of_exponent_2_5']:.2f}",
        "c_error": f"{r['standard_error_of_C_of_exponent_2_5']:.2f}",
        "free": f"{r['beverloo_exponent_of_free_k']:.1f}",
        "free_error": f"{r['standard_error_of_exponent_of_free_k']:.1f}",
        "free_k": f"{r['beverloo_free_k']:.1f}",
        "free_k_error": f"{r['standard_error_of_free_k']:.1f}",
        "height": f"{r['rate_high_over_low_fill']:.2f}",
        "height_error": f"{r['standard_error_of_high_over_low']:.2f}",
    }


def rotating_drum(r, csv, json):
    return {
        "angle": f"{r['angle_of_repose_deg']:.1f}",
        "angle_error": f"{r['angle_standard_error_deg']:.1f}",
        "scatter": f"{r['angle_scatter_deg']:.1f}",
        "lacey_start": f"{r['lacey_start']:.2f}",
        "lacey_end": f"{r['lacey_end']:.2f}",
        "unlike_start": f"{r['unlike_contacts_start']:.2f}",
        "unlike_end": f"{r['unlike_contacts_end']:.2f}",
        "radial_start": f"{r['radial_segregation_start']:.2f}",
        "radial_end": f"{r['radial_segregation_end']:.2f}",
    }


def mill(r, csv, json):
    mean = {name: m["mean"] for name, m in r["means_of_second_half"].items()}
    mass, diameter, length, turns = mean["mass_kg"], 0.4, 0.06, 50.0
    power, by_arm = mean["power_W"], -mass * 9.81 * mean["centre_x_m"] * turns * 2.0 * math.pi / 60.0
    filling = mass / 7800.0 / 0.6 / (math.pi / 4.0 * diameter**2 * length)
    critical = turns / (42.3 / math.sqrt(diameter))

    def bond(d):  # W/kg of balls
        return 4.879 * d**0.3 * (3.2 - 3.0 * filling) * critical * (1.0 - 0.1 / 2.0 ** (9.0 - 10.0 * critical))

    return {
        "power": f"{power:.1f}",
        "interval": f"{r['means_of_second_half']['power_W']['interval95']:.1f}",
        "by_arm": f"{by_arm:.1f}",
        "apart": f"{100.0 * abs(power / by_arm - 1.0):.1f}",
        "mass": f"{mass:.2f}",
        "arm": f"{-1e3 * mean['centre_x_m']:.1f}",
        "filling": f"{filling:.2f}",
        "critical": f"{100.0 * critical:.0f}",
        "bond": f"{bond(diameter) * mass:.0f}",
        "per_kg": f"{power / mass:.2f}",
        "at_3m": f"{power / mass * math.sqrt(3.0 / diameter):.1f}",
        "bond_3m": f"{bond(3.0):.1f}",
    }


def repose_rolling(r, csv, json):
    row = csv("angle_of_repose.csv")[0]
    return {"angle": f"{row['angle_deg']:.0f}", "error": f"{row['standard_error_deg']:.1f}"}


def angle_of_repose(r, csv, json):
    return {
        "rows": table(csv("angle_of_repose.csv"),
            [("friction [-]", "friction", ".2f"), ("angle [degrees]", "angle_deg", ".1f"),
                ("standard error of the mean of three heaps [degrees]", "standard_error_deg", ".1f")]),
    }


def filter_curve(r, csv, json):
    return {
        "product": f"{r['r_k_k_s_per_m2']['value']:.3g}".replace("e+0", "e"),
        "product_low": f"{r['r_k_k_s_per_m2']['low']:.3g}".replace("e+0", "e"),
        "product_high": f"{r['r_k_k_s_per_m2']['high']:.3g}".replace("e+0", "e"),
        "medium": f"{r['r_m_per_m']['value']:.3g}".replace("e+0", "e"),
        "medium_low": f"{r['r_m_per_m']['low']:.3g}".replace("e+0", "e"),
        "medium_high": f"{r['r_m_per_m']['high']:.3g}".replace("e+0", "e"),
    }


def filter_ranges(r, csv, json):
    rows = csv("filter_ranges.csv")
    families = [("of t / V, of time, of volume, in proportion to t; independent",
                 ("equal t/V", "time", "volume", "proportional")),
                ("of time, t / V, volume; correlation 0.6 from reading to reading",
                 ("time, AR 0.6", "t/V, AR 0.6", "volume, AR 0.6")),
                ("a balance that wanders: errors add up to 0.8 %", ("balance walks",)),
                ("a balance that drifts in proportion to time, 1.2 %", ("balance drifts",))]

    wide = [row for row in rows if row["spacing"] != "even"]
    rows = [row for row in rows if row["spacing"] == "even"]

    def held(known, scatters, low, high, among=rows):
        chosen = [row[key] for row in among for key in ("slope", "intercept", "half", "whole", "twice")
                  if row["known"] == known and row["scatter"] in scatters and low <= row["readings"] <= high]
        return f"{min(chosen):.0f} to {max(chosen):.0f} %" if chosen else ""

    def wider(readings):
        of = {known: next(row["half_width"] for row in rows
                          if row["known"] == known and row["scatter"] == "time" and row["readings"] == readings)
              for known in ("nothing", "independent")}
        return of["nothing"] / of["independent"]

    kinds = [{"name": name,
              "nothing": [held("nothing", scatters, low, high) for low, high in ((3, 13), (30, 30), (200, 200))],
              "independent": held("independent", scatters, 3, 200), "drift": held("drift", scatters, 3, 200)}
             for name, scatters in families]
    spread = [{"name": name, "few": held("nothing", scatters, 3, 5, wide),
               "more": held("nothing", scatters, 6, 20, wide),
               "independent": held("independent", scatters, 3, 20, wide),
               "drift": held("drift", scatters, 3, 20, wide)} for name, scatters in families]
    return {
        "wide": table(spread, [("scatter", "name", ""), ("nothing given, 3 to 5 readings", "few", ""),
                               ("6 to 20", "more", ""), ("`independent`, 3 to 20", "independent", ""),
                               ("`drift_error`, 3 to 20", "drift", "")]),
        "rows": table(kinds,
                      [("scatter", "name", ""), ("nothing given, 3 to 13 readings", lambda x: x["nothing"][0], ""),
                ("30", lambda x: x["nothing"][1], ""), ("200", lambda x: x["nothing"][2], ""),
                ("`independent`, 3 to 200", "independent", ""), ("`drift_error`, 3 to 200", "drift", "")]),
        "wider_8": f"{wider(8):.1f}",
        "wider_200": f"{wider(200):.1f}",
    }


def screen_deck(r, csv, json):
    return {
        "runs": table(r["runs"], [("feed [t/h]", "feed_t_h", ".0f"), ("steady from [s]", "measured_from_s", ".2f"),
                ("over the end [kg/s]", lambda x: (
                        f"{x['decks'][0]['over_kg_s']['value']:.3f} +- "
                        f"{x['decks'][0]['over_kg_s']['interval_95']:.3f}"),
                    ""),
                ("through [kg/s]", lambda x: (
                        f"{x['decks'][0]['through_kg_s']['value']:.3f} +- "
                        f"{x['decks'][0]['through_kg_s']['interval_95']:.3f}"),
                    ""),
                ("undersize recovered", lambda x: (
                        f"{x['decks'][0]['undersize_recovery']['value']:.3f} +- "
                        f"{x['decks'][0]['undersize_recovery']['interval_95']:.3f}"),
                    ""),
                ("undersize in over", lambda x: (
                        f"{x['decks'][0]['undersize_in_over']['value']:.3f} +- "
                        f"{x['decks'][0]['undersize_in_over']['interval_95']:.3f}"),
                    ""),
                ("d50 [mm]", lambda x: 1e3 * x["decks"][0]["d50_m"], ".2f"),
                ("imperfection", lambda x: x["decks"][0]["imperfection"], ".3f"),
                ("stay, mean, 10 and 90 % [s]", lambda x: (
                        f"{x['decks'][0]['stay_mean_s']:.2f}, {x['decks'][0]['stay_10_s']:.2f}, "
                        f"{x['decks'][0]['stay_90_s']:.2f}"),
                    ""),
                ("grains fed, missing", lambda x: f"{x['grains']['placed']}, {x['grains']['missing']}", "")]),
        "partition": table([
                (
                    [1e3 * r["runs"][0]["decks"][0]["diameter_m"][c]]
                    + [
                        f"{q['decks'][0]['partition'][c]:.3f} +- {q['decks'][0]['partition_interval_95'][c]:.3f}"
                        for q in r["runs"]])
                for c in range(len(r["runs"][0]["decks"][0]["diameter_m"]))],
            [("diameter [mm]", 0, ".2f"), ("over the end, first feed", 1, ""), ("second feed", 2, "")]),
        "areas": table((
                [(
                        ["DEM", "-", "-"]
                        + [q["deck_area_by_dem_m2"] for q in r["runs"]]
                        + [q["recovered_by_dem"] for q in r["runs"]]
                        + [None])]
                + [
                    ["model " + m["model"], m["deviation_fitted"], m["deviation_predicted"], m["deck_area_first_m2"],
                        m["deck_area_second_m2"], m["recovered_first"], m["recovered_second"], m["largest_feed_t_h"]]
                    for m in r["models"]
                    if m["status"] == "ok"]),
            [("", 0, ""),
                ("deviation at the first feed, fitted", lambda x: x[1] if x[1] == "-" else format(x[1], ".3f"), ""),
                ("at the second, predicted", lambda x: x[2] if x[2] == "-" else format(x[2], ".3f"), ""),
                ("area, first feed [m2]", 3, ".2f"), ("second feed [m2]", 4, ".2f"),
                ("passed at the end, first feed", 5, ".3f"), ("second feed", 6, ".3f"),
                ("largest feed [t/h]", lambda x: "-" if x[7] is None else format(x[7], ".0f"), "")]),
        "oversize": f"{1e2 * r['runs'][0]['decks'][0]['oversize_in_through']['value']:.2f}",
        "largest": f"{1e3 * r['runs'][0]['decks'][0]['largest_through_m']:.2f}",
    }


def screen_deck_two(r, csv, json):
    return {
        "decks": table(r["runs"][0]["decks"],
            [("aperture [mm]", lambda x: 1e3 * x["aperture_m"], ".1f"), ("over the end [kg/s]",
                    lambda x: f"{x['over_kg_s']['value']:.3f} +- {x['over_kg_s']['interval_95']:.3f}", ""),
                ("through [kg/s]",
                    lambda x: f"{x['through_kg_s']['value']:.3f} +- {x['through_kg_s']['interval_95']:.3f}", ""),
                ("undersize recovered",
                    lambda x: f"{x['undersize_recovery']['value']:.3f} +- {x['undersize_recovery']['interval_95']:.3f}",
                    ""),
                ("undersize in over",
                    lambda x: f"{x['undersize_in_over']['value']:.3f} +- {x['undersize_in_over']['interval_95']:.3f}",
                    ""),
                ("d50 [mm]", lambda x: 1e3 * x["d50_m"], ".2f"),
                ("imperfection", lambda x: x["imperfection"], ".3f")]),
    }


def cases(r, csv, json):
    return {
        "top_layer": table([
                f
                for f in r["findings"]
                if "bottom layer" in f["claim"] or "layer of both" in f["claim"] or "more water extends" in f["claim"]],
            [("the paper", "claim", ""), ("here", "numbers", ""), ("", "verdict", "")]),
        "confirmed": sum(f["verdict"] == "confirmed" for f in r["findings"]),
        "refuted": sum(f["verdict"] == "refuted" for f in r["findings"]),
        "scatter": sum(f["verdict"] == "within the scatter" for f in r["findings"]),
        "statements": len(r["findings"]),
        "findings": table(r["findings"], [("the paper", "claim", ""), ("here", "numbers", ""), ("", "verdict", "")]),
        "stagnation": table([("small", "small"), ("near-mesh", "near_mesh")], (
                [("dry, A = 0.8 mm, left at 20 s", 0, "")]
                + [
                    (f"{r['cases'][k]['frequency_hz']:.1f} Hz", lambda x, k=k: (
                            f"{r['cases'][k]['retained_' + x[1] + '_20_s']['mean']:.3f} +- "
                            f"{r['cases'][k]['retained_' + x[1] + '_20_s']['interval_95']:.3f}"),
                        "")
                    for k in range(3)])),
        "model_2_high": [f["numbers"] for f in r["findings"]
                         if "model 2 with the published" in f["claim"]][0].split(" cases ")[1].split(";")[0],
        "stay_low": f"{100 * min(r['cases'][k]['retained_near_mesh_20_s']['mean'] for k in range(3)):.0f}",
        "stay_high": f"{100 * max(r['cases'][k]['retained_near_mesh_20_s']['mean'] for k in range(3)):.0f}",
        "case_23": table([r["cases"][22]], (
                [("case 23, left", lambda x: "5 % of water", "")]
                + [
                    (f"{name}, {t} s", lambda x, t=t, kind=kind: (
                            f"{x[f'retained_{kind}_{t}_s']['mean']:.3f} +- "
                            f"{x[f'retained_{kind}_{t}_s']['interval_95']:.3f}"),
                        "")
                    for name, kind in (("small", "small"), ("near-mesh", "near_mesh"))
                    for t in (5, 20)])),
    }


def filtration_drag(r, csv, json):
    return {
        "drag": table([d for d in r["drag"] if d["cells_per_diameter"] > 14],
            [("method", lambda x: x["method"].replace("_", " "), ""),
                ("largest error at 15 cells", lambda x: f"{1e2 * x['largest_error']:.2f} %", "")]),
    }


def filtration_rates(r, csv, json):
    names = {"bare": "bare fluid, periodic", "sphere": "one moving sphere of 20 cells", "faces": "two pressure faces",
             "walls": "six walls",
        "bed": "bed at rest: 64 spheres of 15 cells, porosity 0.57", "moving_bed": "the same spheres, moving"}
    rows = [x for x in r["rates"] if x["precision"] == "double" and x["case"] in names]
    return {
        "rates": table(rows,
                       [("what", lambda x: names[x["case"]], ""), ("million nodes a second", "mlups", ".0f"),
                        ("over bare", "over_bare", ".2f")]),
    }


def fluid_physics(r, csv, json):
    return {
        "cases": table(r["cases"], [("case", "case", ""), ("cells a diameter", "cells_per_diameter", ".3g"),
            ("error", lambda x: f"{1e2 * x['error']:+.1f} %", ""), ("processor time [s]", "processor_s", ".2g")]),
    }


def filtration_moving(r, csv, json):
    return {
        "noise": table(r["noise"], [("relaxation time", "tau", ".1f"), ("bulk viscosity / nu", "bulk_ratio", ".3g"),
                ("drag", lambda x: f"{1e2 * x['drag_flicker']:.2f} %", ""),
                ("pressure [rho u^2]", "pressure_flicker_over_rho_u2", ".4f")]),
        "speeds": table(r["speeds"],
            [("Mach", "mach", ".1f"), ("u dx / nu", "cell_reynolds", ".0f"), ("relaxation time", "tau", ".4f"),
                ("ends",
                    lambda x: x["end"] if x["end"] == "ok" else f"{x['end']}, step {x['steps']} of {x['of_steps']}",
                    "")]),
        "mass_steps": f"{r['mass_steps']:.0e}".replace("e+0", "e"),
        "mass_drift": f"{r['mass_drift']:.1e}",
        "mass_largest": f"{r['mass_drift_largest']:.1e}",
        "mass_kept": f"{r['mass_kept_largest']:.0e}",
    }


def settling(r, csv, json):
    return {
        "cases": table(csv("table.csv"),
            [("case", "case", ""), ("cells a diameter", "cells", ".3g"), ("tau", "tau", ".3g"),
                ("v [mm/s]", lambda x: 1e3 * x["v_m_per_s"], ".3f"), ("Re", "re", ".3g"), ("reference [mm/s]",
                    lambda x: "-" if x["ratio"] != x["ratio"] else f"{1e3 * x['reference_m_per_s']:.3f}", ""),
                ("v / reference", lambda x: "-" if x["ratio"] != x["ratio"] else f"{x['ratio']:.4f}", ""),
                ("steps", "steps", ".0f")]),
    }


def settling_alike(r, csv, json):
    runs = {x["case"]: x for x in csv("alike.csv")}
    ratio = runs["D1"]["v_m_per_s"] / runs["A1"]["v_m_per_s"]
    return {
        "cases": table(list(runs.values()), [("case", "case", ""), ("v [mm/s]", lambda x: 1e3 * x["v_m_per_s"], ".3f"),
            ("over reference", lambda x: f"{x['v_m_per_s'] / x['reference_m_per_s']:.3f}", ""),
            ("gap with 95 % of v [diameters]", lambda x: "-" if x["gap_95"] != x["gap_95"]
             else f"{x['gap_95']:.2f}", ""),
            ("with half of v", lambda x: "-" if x["gap_50"] != x["gap_50"] else f"{x['gap_50']:.2f}", "")]),
        "cloth": f"{1e2 * (ratio - 1.0):+.2f}",
    }


def own_screen(r, csv, json):
    return {
        "models": table([
                (
                    [k.replace("_", " ")]
                    + [r[k]["answer"][a] for a in ("time_s", "low_s", "high_s")]
                    + [r[k][a] for a in ("d50_m", "d50_low_m", "d50_high_m")]
                    + [q["efficiency"], q["bed_depth_end_m"], q["capacity_kg_per_s"], q["capacity"]])
                for k, q in zip(("first_order", "dong", "subasinghe", "soldinger"), r["deck"])],
            [("model", 0, ""),
                ("time to 90 %, holes blocking [s]", lambda x: "not within 40" if x[1] is None else f"{x[1]:.2f}",
                    ""),
                ("95 % range", lambda x: (
                        "-"
                        if x[2] is None
                        else f"{x[2]:.1f} .. " + ("> 40" if x[3] is None else f"{x[3]:.1f}")),
                    ""),
                ("d50 then [mm]", lambda x: "-" if x[4] is None else f"{1e3 * x[4]:.2f}", ""),
                ("95 % range", lambda x: "-" if x[5] is None else f"{1e3 * x[5]:.2f} .. {1e3 * x[6]:.2f}", ""),
                ("the deck passes of the undersize", 7, ".3f"),
                ("bed at its end [mm]", lambda x: f"{1e3 * x[8]:.1f}", ""),
                ("largest feed for 90 % [kg/s]", lambda x: (
                        "load not known"
                        if x[9] is None
                        else f"{x[9]:.3g}" + ("" if x[10] == "ok" else ", outside the fit")),
                    "")]),
    }


def filter_cake_short(r, csv, json):
    return {
        "clean": f"{r['r_m0_per_m']:.3g}".replace("e+0", "e"),
        "first": f"{1e3 * r['t_first_particle_s']:.1f}",
        "generated": r["particles_generated"],
        "noise": f"{1e9 * r['force_noise_n']:.0f}",
    }


def calibration(r, csv, json):
    friction, heap = r["parameters"]["friction"], r["targets"][0]
    return {key: f"{friction[key]:.2f}" for key in ("value", "low", "high")} | {
        "heap_low": f"{heap['simulated_low']:.1f}", "heap_high": f"{heap['simulated_high']:.1f}"}


def cake_of_three_seeds(voxels, json):
    runs = [json(f"{seed}.json") for seed in (1, 2, 3)]

    def filtrate(run):
        v, t = run["filtrate_velocity_m_per_s"], run["time_s"]
        return sum(0.5 * (a + b) * (d - c) for a, b, c, d in zip(v, v[1:], t, t[1:]))

    def mean(of, digits, unit="", factor=1.0):
        """Mean over the seeds and its 95 % interval (Student's, 2 degrees of freedom)."""
        values = [factor * of(run) for run in runs]
        half = 4.303 * statistics.stdev(values) / math.sqrt(len(values))
        number = f"{statistics.mean(values):.{digits}f} ± {half:.{digits}f}"
        return f"({number}){unit}" if unit.startswith("e") else number + unit

    def resistance(run):
        return (1e6 / run["filtrate_velocity_m_per_s"][-1] - run["r_m0_per_m"]) / run["cake_height_m"]

    rows = [("spheres that came with the filtrate", mean(lambda x: x["particles_generated"], 0),
             "161 (of four times the area: 40 here)"),
            ("spheres in the cake", mean(lambda x: x["particles_deposited"], 0), "145 (36 here)"),
            ("first sphere on the cloth", mean(lambda x: x["t_first_particle_s"], 1, " ms", 1e3), "3.9 ms"),
            ("height of the cake: twice its centre", mean(lambda x: x["cake_height_m"], 0, " um", 1e6),
             "500 um; 320 um follow from its time, volume and r_K"),
            ("height of its top", mean(lambda x: x["cake_top_m"], 0, " um", 1e6), ""),
            ("porosity", mean(lambda x: x["cake_porosity"], 2), "0.67 follows from 500 um, 0.48 from r_K"),
            ("r_K by Kozeny and Carman", mean(lambda x: x["r_k_kozeny_per_m2"], 2, "e11 1/m2", 1e-11), ""),
            ("r_K from the last velocity and the height", mean(resistance, 2, "e11 1/m2", 1e-11), ""),
            ("r_K from the line of the filter curve", mean(lambda x: x["r_k_per_m2"], 2, "e11 1/m2", 1e-11),
             "7.8e10 1/m2"),
            ("filtrate over 20 cm2 in 98 ms", mean(filtrate, 1, " mL", 20.0e-4 * 1e6), "14 mL")]
    return {
        "results": table(rows, [("", lambda x: x[0], ""), (f"unit cell, {voxels}, three seeds", lambda x: x[1], ""),
                                ("paper", lambda x: x[2], "")]),
    }


def filter_cake(r, csv, json):
    return cake_of_three_seeds("7.5 um", json)


def filter_cake_fine(r, csv, json):
    return cake_of_three_seeds("5 um", json)


def filter_cake_plain(r, csv, json):
    return {
        "clean": f"{r['r_m0_per_m']:.3g}".replace("e+0", "e"),
        "noise": f"{1e9 * r['force_noise_n']:.0f}",
    }


def classifier_gas(r, csv, json):
    return {
        "rows": table(csv("approach_in_gas.csv"),
            [("1/min", "rpm", ".0f"), ("hit speed / rim", lambda x: f"{x['speed_straight']:.3f}", ""),
                ("in gas", lambda x: f"{x['speed_in_gas']:.3f}", ""), ("angle [°]", "angle_straight_deg", ".1f"),
                ("in gas [°]", "angle_in_gas_deg", ".1f"), ("x50, case A [um]", "x50_clean_straight_um", ".2f"),
                ("in gas [um]", "x50_clean_in_gas_um", ".2f"), ("x50 [um]", "x50_straight_um", ".2f"),
                ("in gas [um]", "x50_in_gas_um", ".2f")]),
    }


def paddle_gap(r, csv, json):
    runs = csv("runs.csv")

    def run(shape, cor, loading, rpm=9000, x_min=30):
        return next(x for x in runs if (x["shape"], x["cor"], x["loading"], x["rpm"], x["x_min_um"], x["drag"]) ==
                    (shape, cor, loading, rpm, x_min, "on") and x["contact_ns"] != 10)

    def mean(x):
        return f"{x['particles']:.2f} ± {1.96 * x['particles_error']:.2f}"

    def ratio(a, b):
        """Contacts between particles of a over those of b, with its 95 % interval."""
        of = a["particles"] / b["particles"]
        error = of * math.hypot(*(x["particles_error"] / x["particles"] for x in (a, b)))
        return f"{of:.2f} ± {1.96 * error:.2f}"

    whole = [x for x in runs if x["unfinished"] == 0]
    bricks = [x for x in whole if x["shape"] in ("brick", "both")]
    stopped = next(x for x in runs if x["unfinished"] > 0)
    case = [("shape", "shape", ""), ("restitution", "cor", ".2f"), ("1/min", "rpm", ".0f"),
        ("loading [kg/kg]", "loading", ".0f"), ("from [um]", "x_min_um", ".0f")]
    kinds = [("bricks 0.50", "brick", 0.5), ("spheres 0.29", "sphere", 0.29), ("spheres 0.75", "sphere", 0.75)]

    low, high = run("brick", 0.29, 3), run("brick", 0.5, 3)
    matching = 0.29 + (0.5 - 0.29) * (0.29 - low["rebound"]) / (high["rebound"] - low["rebound"])

    def beside(titles, rows):
        """A table of contacts between particles; rows: cells, loading, 1/min, smallest size."""
        rows = [[cells] + [run(shape, cor, *of) for _, shape, cor in kinds] for cells, *of in rows]
        return table(rows, [(title, lambda x, k=k: x[0][k], "") for k, title in enumerate(titles)] + [
                (name, lambda x, k=k: f"{mean(x[k])} (sd {x[k]['particles_sd']:.1f})", "")
                for k, (name, _, _) in enumerate(kinds, 1)] + [
                (f"{name} / bricks", lambda x, k=k: ratio(x[k], x[1]), "")
                for k, (name, _, _) in enumerate(kinds, 1) if k > 1])

    return {
        "rows": table(whole, case + [("drag", "drag", ""), ("contact [ns]", "contact_ns", ".0f"),
                ("histories", "histories", ".0f"),
                ("contacts", lambda x: f"{x['contacts']:.2f} ± {1.96 * x['contacts_error']:.2f}", ""),
                ("with paddles", "paddles", ".2f"), ("with particles", "particles", ".2f"),
                ("first hit [mm]", "hit_mm", ".3f"), ("speed / rim", "speed_over_rim", ".3f"),
                ("stay [ms]", "stay_ms", ".3f"), ("x50 [um]", "x50_um", ".2f")]),
        "gaps": table([x for x in runs if x["drag"] == "on"], case + [("contact [ns]", "contact_ns", ".0f"),
                ("slice [mm]", "depth_mm", ".2f"), ("time [ms]", "time_ms", ".1f"), ("entered", "entered", ".0f"),
                ("inside at the end", "present", ".0f"), ("with particles, first half", "particles_early", ".2f"),
                ("second half", "particles_late", ".2f"), ("longest stay [ms]", "longest_ms", ".2f"),
                ("core overlaps", "core_overlaps", ".0f"), ("processor time [s]", "processor_s", ".0f")]),
        "rebounds": table([x for x in whole if x["drag"] == "on"], case + [("contact [ns]", "contact_ns", ".0f"),
                ("rebound from a paddle", lambda x: f"{x['rebound']:.2f} (sd {x['rebound_sd']:.2f})", ""),
                ("angle off the mirrored one, sd [degrees]", "angle_deg", ".0f"), ("rebounds", "rebounds", ".0f")]),
        "speeds": beside(["1/min"], [([rpm], 40, rpm, 60) for rpm in (3000, 9000, 15000)]),
        "loads": beside(["loading [kg/kg]", "from [um]"], [([loading, x_min], loading, 9000, x_min)
                for loading, x_min in ((3, 30), (10, 30), (40, 60), (40, 45))]),
        "fifth_10": ratio(run("sphere", 0.75, 10), run("brick", 0.5, 10)).replace(" ", ""),
        "fifth_40_60": ratio(run("sphere", 0.75, 40, x_min=60), run("brick", 0.5, 40, x_min=60)).replace(" ", ""),
        "fifth_40_45": ratio(run("sphere", 0.75, 40, x_min=45), run("brick", 0.5, 40, x_min=45)).replace(" ", ""),
        "matching": f"{matching:.2f}",
        "angle_beads": f"{run('sphere', 0.75, 40)['angle_deg']:.0f}",
        "angle_bricks": f"{run('brick', 0.5, 40, x_min=60)['angle_deg']:.0f}",
        "rebound_bricks": f"{run('brick', 0.5, 3)['rebound']:.2f}",
        "rebound_bricks_40": f"{run('brick', 0.5, 40, x_min=60)['rebound']:.2f}",
        "stay_beads": f"{run('sphere', 0.75, 3)['stay_ms']:.2f}",
        "stay_spheres": f"{run('sphere', 0.29, 3)['stay_ms']:.2f}",
        "stay_bricks": f"{run('brick', 0.5, 3)['stay_ms']:.2f}",
        "bricks": f"{sum(x['histories'] for x in bricks):.0f}",
        "overlapping": f"{sum(x['core_overlaps'] > 0 for x in bricks)}",
        "brick_longest": f"{max(x['longest_ms'] for x in bricks):.1f}",
        "stopped_inside": f"{stopped['present']:.0f}",
        "stopped_entered": f"{stopped['entered']:.0f}",
        "stopped_time": f"{stopped['time_ms']:.1f}",
        "processor_minutes": f"{sum(x['processor_s'] for x in runs) / 60:.0f}",
    }


def classifier_cuts(r, csv, json):
    return {
        "rows": table([[n, json(f"equivalent_{n}.json"), json(f"projected_{n}.json")] for n in [3000, 9000, 15000]], (
                [("1/min", 0, "")]
                + [
                    (title, lambda x, k=k, of=of: (
                            " ".join(f"{1e6 * x[of][f'x{q}_m']:.2f}" for q in [25, 50, 75])
                            if k
                            else f"{x[of]['sharpness']:.3f}"[1:]),
                        "")
                    for of, title, k in [(1, "equivalent area", 1), (1, "κ", 0),
                                         (2, "projected area", 1), (2, "κ", 0)]]
                + [("eq 3", lambda x: f"{1e6 * x[1]['eq3_m']:.2f}", ""), ("eq 6 equivalent / projected",
                        lambda x: f"{1e6 * x[1]['eq6_m']:.2f} / {1e6 * x[1]['eq6_projected_m']:.2f}", "")])),
        "coarser": "/".join(
            f"{100 * (json(f'projected_{n}.json')['x50_m'] / json(f'equivalent_{n}.json')['x50_m'] - 1):.1f}"
            for n in [3000, 9000, 15000]),
    }


def granulator(r, csv, json):
    return {
        "tables": table(csv("table2.csv") + [x for x in csv("table3.csv") if abs(x["binder"] - 0.33) > 0.01],
            [("", lambda x: (
                        f"{x['rpm']:.0f} rpm"
                        if abs(x["binder"] - 0.33) < 0.01
                        else f"{100 * x['binder']:.0f} % binder"),
                    ""),
                ("Type I [%]", lambda x: f"{x['type1_pct']:.1f} +- {x['type1_ci95']:.1f}", ""),
                ("paper", lambda x: x["paper_type1_pct"] or "-", ""),
                ("Type II [%]", lambda x: f"{x['type2_pct']:.1f} +- {x['type2_ci95']:.1f}", ""),
                ("paper", lambda x: x["paper_type2_pct"] or "-", ""), ("rebound [%]", "rebound_pct", ".1f"),
                ("paper", lambda x: x["paper_rebound_pct"] or "-", ""),
                ("d43 [um]", lambda x: f"{1e6 * x['d43_m']:.0f} +- {1e6 * x['d43_ci95']:.0f}", ""),
                ("paper", lambda x: f"{1e6 * x['paper_d43_m']:.1f}" if x["paper_d43_m"] else "-", ""),
                ("collisions", "interactions", ".0f")]),
        "sizes": table([x for x in r["rows"] if x["study"] == "impeller"], (
                [("rpm", "rpm", ".0f")]
                + [(f"{k} [um]", lambda x, k=k: f"{1e6 * x[k + '_m']:.0f}", "") for k in ["d10", "d30", "d32"]]
                + [("d43 [um]", lambda x: f"{1e6 * x['mean_size_m']:.0f}", "")]
                + [(f"{k} [um]", lambda x, k=k: f"{1e6 * x[k + '_m']:.0f}", "") for k in ["x10", "x50", "x90"]]
                + [("span", "span", ".2f")])),
        "sound": table([
                [name, [x for x in csv("sound.csv") if x["reading"] == k]]
                for k, name in [(0, "G1"), (1, "G1, momentum conserved"),
                    (4, "swept, conserved, velocities drawn again each step"), (5, "+ random sign of each component"),
                    (6, "+ two opposed streams instead, G1's material unchanged"),
                    (7, "the same, mu 0.0496, r 0.0366, D* 226 um, dilation 1.03e5")]],
            [("reading", 0, ""), ("mean error of I and II, points",
                    lambda x: sum(abs(q["type1_pct"] - q["paper_type1_pct"])
                                  + abs(q["type2_pct"] - q["paper_type2_pct"]) for q in x[1]) / (2 * len(x[1])),
                    ".2f"),
                ("of d43 [um]", lambda x: 1e6 * sum(abs(q["d43_m"] - q["paper_d43_m"]) for q in x[1]) / len(x[1]),
                    ".1f"),
                ("I / II at 120, 360, 720, 840 rpm",
                    lambda x: ", ".join(f"{q['type1_pct']:.1f}/{q['type2_pct']:.1f}" for q in x[1][:4]), "")]),
        "conserved": "/".join(
            f"{sum(x[k] for x in csv('sound.csv') if x['reading'] == 1 and x['binder'] > 0.3) / 4:.1f}"
            for k in ["type1_pct", "type2_pct"]),
        "map_events": [f"{x['interactions']:.0f}" for x in r["rows"] if x["study"] == "map"][0],
        "map_rebound": [f"{x['rebound_pct']:.1f}" for x in r["rows"] if x["study"] == "map"][0],
        "map_type2": [f"{x['type2_pct']:.1f}" for x in r["rows"] if x["study"] == "map"][0],
        "map_type1": [f"{x['type1_pct']:.1f}" for x in r["rows"] if x["study"] == "map"][0],
        "map_st_v": [f"{x['st_v_type2_over_type1']:.1f}" for x in r["rows"] if x["study"] == "map"][0],
        "map_st_def": [f"{x['st_def_type2_over_type1']:.0f}" for x in r["rows"] if x["study"] == "map"][0],
        "streams_type2": "%.1f" % max(abs(x["type2_pct"] - x["paper_type2_pct"]) for x in csv("sound.csv")
                                      if x["reading"] == 7 and x["binder"] > 0.3),
        **{name: "%.1f" % (1e6 * sum(abs(x["d43_m"] - x["paper_d43_m"]) for x in csv("sound.csv")
                                     if x["reading"] == reading) / 6)
           for name, reading in (("streams_d43", 7), ("g1_d43", 0))},
    }


def wet_screen(r, csv, json):
    return {
        "rows": table(["Dong", "Subasinghe", "Soldinger"], (
                [("model", lambda x: x, "")]
                + [
                    (title, lambda x, k=k, j=j: (
                            f"{r[x][k]['time_s']:.3g} s"
                            if j
                            else (
                                f"{r[x][k]['low_s']:.1f} .. "
                                + (f"{r[x][k]['high_s']:.1f}" if r[x][k]['high_s'] else "> 40"))),
                        "")
                    for k, j, title in [("clean", 1, "holes clean"), ("clean", 0, "95 % range"),
                        ("blocking", 1, "holes blocking, f_inf = 0.5"), ("blocking", 0, "95 % range")]])),
        "dong": f"{r['Dong']['clean']['time_s']:.2f}",
        "subasinghe": f"{r['Subasinghe']['clean']['time_s']:.2f}",
        "soldinger": f"{r['Soldinger']['clean']['time_s']:.1f}",
        "dong_more": f"{100 * (r['Dong']['blocking']['time_s'] / r['Dong']['clean']['time_s'] - 1):.0f}",
        "soldinger_more": f"{100 * (r['Soldinger']['blocking']['time_s'] / r['Soldinger']['clean']['time_s'] - 1):.0f}",
    }


def blocking_sweep(r, csv, json):
    return {
        "rows": table([[x for x in r["sweep"] if x["K"] == K] for K in sorted({x["K"] for x in r["sweep"]})], (
                [("K", lambda x: f"{x[0]['K']:g}", "")]
                + [
                    (f"f(0), f at the end, x_h = {r['sweep'][5 * j]['x_h']:g}",
                        lambda x, j=j: f"{x[j]['free_fraction'][0]:.3f}, {x[j]['free_fraction'][-1]:.3f}", "")
                    for j in range(3)]
                + [("f* there", lambda x: ", ".join(f"{y['f_star']:.3f}" for y in x), ""),
                    ("f* of Table 3", lambda x: ", ".join(f"{y['f_star_table3']:.3f}" for y in x), "")])),
    }


def screen_fit(r, csv, json):
    return {
        "deviations": table([["0 first order", "model0"], ["1 Dong", "model1"], ["1 Dong, grain", "model1_grain"],
                ["2 Subasinghe", "model2"], ["3 Soldinger", "model3"]],
            [("model", 0, ""), ("published", lambda x: (
                        format(r["published"][x[1]]["average_deviation"], ".4f")
                        if x[1] in r["published"]
                        else "-"),
                    ""),
                ("one set", lambda x: r["fitted_all"][x[1]]["average_deviation"], ".4f"),
                ("the paper", lambda x: r["fitted_all"][x[1]]["paper_average_deviation"] or "-", ""),
                ("one set a case", lambda x: r["fitted_each"][x[1]]["average_deviation"], ".4f"),
                ("the paper", lambda x: r["fitted_each"][x[1]]["paper_average_deviation"] or "-", "")]),
        "sets": table([
                (
                    [m[0] + ": " + ", ".join(r["fitted_all"][m[1]]["parameters"])]
                    + [
                        format(v, ".5g") + ("?" if k in r["fitted_all"][m[1]]["not_determined"] else "")
                        for k, v in r["fitted_all"][m[1]]["parameters"].items()]
                    + [""] * (6 - len(r["fitted_all"][m[1]]["parameters"])))
                for m in [["0 first order", "model0"], ["1 Dong", "model1"], ["1 Dong, grain", "model1_grain"],
                    ["2 Subasinghe", "model2"], ["3 Soldinger", "model3"]]],
            [("one set for all 27", 0, ""), ("", 1, ""), ("", 2, ""), ("", 3, ""), ("", 4, ""), ("", 5, ""),
                ("", 6, "")]),
        "predictions": table([
                (
                    [name.replace("_", " ")]
                    + [
                        r["predicted"][name][m]["average_deviation"]
                        for m in ["model0", "model1", "model1_grain", "model2", "model3"]])
                for name in ["interpolation", "extrapolation_down", "extrapolation_up", "five_from_four"]],
            [("predicted", 0, ""), ("0", 1, ".4f"), ("1", 2, ".4f"), ("1, grain", 3, ".4f"), ("2", 4, ".4f"),
                ("3", 5, ".4f")]),
        "statements": table([
                [a["claim"], ("**confirmed**: " if a["holds"] else "**refuted**: ") + a["numbers"],
                    "the same" if a == b else ("**confirmed**: " if b["holds"] else "**refuted**: ") + b["numbers"]]
                for a, b in zip(r["findings_with_model1"], r["findings_with_model1_grain"])],
            [("the paper, section 5.3", 0, ""), ("here, models 1, 2, 3", 1, ""),
                ("with model 1 by the grain", 2, "")]),
        "groups": table(csv("fig10d.csv"), (
                [("fitted", "fitted", "")]
                + [
                    (title, f"{kind}{k}", ".4f")
                    for k in range(1, 4)
                    for title, kind in [(f"model {k}", "model"), ("audit", "audit")]])),
        "published": table([["1, Y", "model1"], ["1, grain", "model1_grain"], ["2", "model2"], ["3", "model3"]],
            [("published parameters, deviation from these curves", lambda x: "model " + x[0], ""), ("A = 0.8 mm",
                    lambda x: sum(r["published"][x[1]]["case_deviation"][k] for k in range(27) if k % 9 < 3) / 9,
                    ".4f"),
                ("A = 1.0 and 1.2 mm",
                    lambda x: sum(r["published"][x[1]]["case_deviation"][k] for k in range(27) if k % 9 >= 3) / 18,
                    ".4f"),
                ("all", lambda x: r["published"][x[1]]["average_deviation"], ".4f"),
                ("the paper, from its own", lambda x: r["fitted_all"][x[1]]["paper_average_deviation"], "")]),
        "held": sum(f["holds"] for f in r["findings_with_model1"]),
        "held_grain": sum(f["holds"] for f in r["findings_with_model1_grain"]),
        "low_1": f"{sum(r['fitted_all']['model1']['case_deviation'][k] for k in range(27) if k % 9 < 3) / 9:.4f}",
        "high_1": f"{sum(r['fitted_all']['model1']['case_deviation'][k] for k in range(27) if k % 9 >= 3) / 18:.4f}",
        "low_2": f"{sum(r['fitted_all']['model2']['case_deviation'][k] for k in range(27) if k % 9 < 3) / 9:.4f}",
        "high_2": f"{sum(r['fitted_all']['model2']['case_deviation'][k] for k in range(27) if k % 9 >= 3) / 18:.4f}",
        "low_3": f"{sum(r['fitted_all']['model3']['case_deviation'][k] for k in range(27) if k % 9 < 3) / 9:.4f}",
        "high_3": f"{sum(r['fitted_all']['model3']['case_deviation'][k] for k in range(27) if k % 9 >= 3) / 18:.4f}",
    }


def brick_rebound(r, csv, json):
    return {
        "rows": table(csv("rebound.csv"),
            [("e of the pair", "restitution", ".2f"), ("COR of the centre", "mean", ".2f"),
                ("its scatter", "scatter", ".2f"), ("scatter of the angle [deg]", "angle_deg", ".0f")]),
    }


def brick_peers(r, csv, json):
    return {
        "rows": table(csv("bricks.csv"),
            [("code", "code", ""), ("bricks", "bodies", ".0f"), ("steps timed", "steps", ".0f"),
                ("processor time [s]", "cpu_s", ".2f"), ("particle-steps per second", "particle_steps_per_s", ".3g"),
                ("Riddle over it", lambda x: csv("bricks.csv")[0]["particle_steps_per_s"] / x["particle_steps_per_s"],
                    ".0f")]),
    }


def brick_pairs(r, csv, json):
    return {
        "rows": table(csv("pairs.csv"),
            [("pair", "pair", ""), ("points", "points", ".1f"), ("to find them [ns]", "known_ns", ".0f"),
                ("without the step before [ns]", "new_ns", ".0f"), ("all of a step [ns]", "step_ns", ".0f")]),
    }


def rocks(r, csv, json):
    beds = csv("300/rocks.csv")
    other = {x["corners"]: x["step_s"] for x in csv("yade.csv")}
    return {
        "rows": table(csv("rocks.csv"),
            [("corners", "corners", ".0f"), ("of the core", "core_corners", ".0f"),
                ("deviation over diameter [%]", lambda x: 100 * x["deviation"], ".1f"),
                ("to make one [ms]", lambda x: 1e3 * x["make_s"], ".1f"), ("points a pair", "points", ".1f"),
                ("to find them [ns]", lambda x: 1e9 * x["points_s"], ".0f"),
                ("all of a step [ns]", lambda x: 1e9 * x["step_s"], ".0f"),
                ("YADE, all of a step [ns]",
                    lambda x: f"{1e9 * other[x['corners']]:.0f}" if x["corners"] in other else "-", "")]),
        "beds": table(beds,
            [("corners", "corners", ".0f"), ("porosity", "porosity", ".3f"), ("contacts a rock", "contacts", ".1f"),
                ("particle-steps per second", "particle_steps_per_s", ".3g"),
             ("core overlaps", "core_overlaps", ".0f")]),
    }


def brick_beds(r, csv, json):
    return {
        "rows": table(csv("beds.csv"),
            [("amplitude of the floor [mm]", "amplitude_mm", ""), ("contacts of 245 bricks", "contacts", ".0f"),
                ("particle-steps per second", "rate", ".3g")]),
    }


def batch_screening(r, csv, json):
    return {
        "top_small": f"{r['top_layer_time_small_s']:.2f}",
        "top_near_mesh": f"{r['top_layer_time_near_mesh_s']:.2f}",
        "energy": f"{r['energy_error_rel']:.1e}",
        "rows": table([
                {"what": f"{name}, {t} s", "paper": paper, "row": csv("retained.csv")[10 * t], "kind": kind}
                for name, kind, t, paper in [("small", "small", 5, "0.13"), ("near-mesh", "near_mesh", 5, "0.20"),
                    ("small", "small", 10, "0.015"), ("near-mesh", "near_mesh", 10, "0.10"),
                    ("small", "small", 15, "about 0"), ("near-mesh", "near_mesh", 15, "about 0")]],
            [("retained", "what", ""), ("paper's text", "paper", ""),
                ("here, 8 seeds, mean and 95 % interval", lambda x: (
                        f"{x['row']['retained_' + x['kind']]:.3f} +- "
                        f"{2.365 * x['row']['retained_' + x['kind'] + '_sd'] / 8 ** 0.5:.3f}"),
                    "")]),
    }


def batch_screening_sensitivity(r, csv, json):
    return {
        "rows": table([x for x in csv("sensitivity.csv") if x["time_s"] == 5], (
                [("", "variant", "")]
                + [
                    (f"{name}, {t} s", lambda x, t=t, kind=kind: next(
                            y[kind]
                            for y in csv("sensitivity.csv")
                            if y["variant"] == x["variant"] and y["time_s"] == t),
                        ".3f")
                    for t in (5, 10)
                    for name, kind in (("small", "small"), ("near-mesh", "near_mesh"))])),
    }


def batch_screening_outlet(r, csv, json):
    return {
        "rows": table([("dry, delay of 0.5 s (default)", "delay", 10), ("dry, outlet wall", "wall", 10),
                ("5 % of water (case 23), steel", "steel", 5), ("5 % of water, PVC", "pvc", 5)],
            (
                [("left", 0, "")]
                + [
                    (f"{name}, {t} s", lambda x, t=t, kind=kind: (
                            ""
                            if t > x[2]
                            else "{:.3f} +- {:.3f}".format(
                                *[(y["retained_" + kind], 2.365 * y["retained_" + kind + "_sd"] / 8 ** 0.5)
                                  for y in [csv(x[1] + "/retained.csv")[10 * t]]][0])),
                        "")
                    for name, kind, t in (("small", "small", 1), ("small", "small", 5), ("near-mesh", "near_mesh", 5),
                        ("small", "small", 10), ("near-mesh", "near_mesh", 10))])),
    }


def batch_screening_laws(r, csv, json):
    return {
        "means": table(r["means"], (
                [("at 5 s", lambda x: f"{100 * x['moisture']:g} % of water, {x['laws']}" if x["laws"] else "dry",
                        "")]
                + [
                    (title, lambda x, k=key: f"{x[k]['mean']:.3f}, {x[k]['sd']:.3f}, +- {x[k]['interval_95']:.3f}",
                        "")
                    for title, key in (("small", "retained_small"), ("near-mesh", "retained_near_mesh"))])),
        "differences": table(list(zip(r["differences"][:8], r["differences"][8:])), (
                [("difference, half its 95 % interval from pairs, the same from independent runs", lambda x: (
                            x[0]["laws"]
                            + (
                                f", {100 * x[0]['to_moisture']:g} %"
                                if x[0]["from_moisture"] == x[0]["to_moisture"]
                                else f", {100 * x[0]['to_moisture']:g} minus {100 * x[0]['from_moisture']:g} %")),
                        "")]
                + [
                    (title, lambda x, c=c: (
                            f"{x[c]['difference']:+.3f}, {x[c]['interval_95_paired']:.3f}, "
                            f"{x[c]['interval_95_independent']:.3f}"),
                        "")
                    for c, title in enumerate(("small", "near-mesh"))])),
        "course": table([x for x in r["differences"] if x["from_moisture"] == 0], (
                [("", lambda x: f"{x['class'].split(' (')[0]}, {100 * x['to_moisture']:g} %, {x['laws']}", "")]
                + [
                    (f"{n + 1} s",
                        lambda x, n=n: f"{x['difference_each_second'][n]:+.3f} +- "
                                       f"{x['interval_95_paired_each_second'][n]:.3f}",
                        "")
                    for n in range(5)])),
    }


def blocking_continuous(r, csv, json):
    return {
        "rows": table([(way, r["continuous"][way]) for way in ("intermittent", "inclined", "continuous")], (
                [("free holes", lambda x: x[0], "")]
                + [
                    (f"{s:g} s",
                        lambda x, k=r["continuous"]["time_s"].index(s): f"{x[1]['free_fraction'][k]:.3f} +- "
                                                                        f"{x[1]['error_95'][k]:.3f}",
                        "")
                    for s in (0, 1, 5)]
                + [("grains of a patch that passed", lambda x: f"{x[1]['passed']:.0f}", "")])),
        "passed": f"{r['continuous']['continuous']['passed'] / r['continuous']['intermittent']['passed']:.0f}",
    }


def bench_liquid_bridge(r, csv, json):
    return {
        "table_ns": f"{next(x['ns'] for x in csv('laws.csv') if x['law'].startswith('table')):.1f}",
        "table_error": f"{1e2 * next(x['largest_error'] for x in csv('laws.csv') if x['law'].startswith('table')):.2f}",
        **{name: f"{scale * next(x[column] for x in csv('laws.csv') if x['law'] == 'Willett, full'):.0f}"
           for name, scale, column in (("willett_ns", 1, "ns"), ("willett_error", 1e2, "largest_error"))},
        "evaluate_ns": f"{1e9 * r['evaluate_s']:.0f}",
        "form_ns": f"{1e9 * r['form_s']:.0f}",
        "allocate_ns": f"{1e9 * r['allocate_s']:.0f}",
        "solve_us": f"{1e6 * r['young_laplace_s']:.0f}",
        "prepare_ms": f"{1e3 * r['prepare_s']:.0f}",
        "prepare_plate_ms": f"{1e3 * r['prepare_plate_s']:.0f}",
    }


def dem_accuracy(r, csv, json):
    return {
        "rows": table([
                {
                    "e": e,
                    "convention": c,
                    **{x["integrator"]: x["error_rms"] for x in csv("dem_accuracy.csv") if x["scene"] == "head-on"
                       and x["steps_per_contact"] == 20 and x["restitution"] == e and x["convention"] == c},
                }
                for e in (0.78, 0.4351)
                for c in ("clipped", "naive")],
            [("e, convention", lambda x: f"{x['e']:g} {x['convention']}", ""), ("dem.h", "dem.h", ".1e"),
                ("predicted Verlet", "predicted Verlet", ".1e"),
                ("leapfrog (LAMMPS, YADE)", "leapfrog (LAMMPS, YADE)", ".1e"),
                ("Verlet over dem.h", lambda x: x["predicted Verlet"] / x["dem.h"], ".0f"),
                ("leapfrog over dem.h", lambda x: x["leapfrog (LAMMPS, YADE)"] / x["dem.h"], ".0f")]),
    }


def dem_mesh(r, csv, json):
    return {
        "plane": f"{1e9 * next(x['step_s'] for x in csv('dem_mesh.csv') if x['triangles'] == 0):.0f}",
        "rows": table([
                x
                for x in csv("dem_mesh.csv")
                if x["triangles"] > 0 and x["spheres"] == min(y["spheres"] for y in csv("dem_mesh.csv"))],
            (
                [("triangles", "triangles", ".0f")]
                + [
                    (f"{n:.0f} spheres [ns a step]",
                        lambda x, n=n: 1e9
                     * next(y["step_s"] for y in csv("dem_mesh.csv") if y["triangles"] == x["triangles"]
                            and y["spheres"] == n),
                        ".0f")
                    for n in sorted({y["spheres"] for y in csv("dem_mesh.csv")})]
                + [("`dem_add_mesh` [ms]", lambda x: (
                            f"{1e3 * x['build_s']:.0f}"
                            if x["build_s"] > 1e-2
                            else f"{1e3 * x['build_s']:.2g}"),
                        "")])),
    }


def dem_scaling(r, csv, json):
    return {
        "rows": table([x for k, x in enumerate(csv("dem_scaling.csv")) if k < 8 or x["size_ratio"] > 1],
            [("state", lambda x: "bed at rest" if x["bed"] else "gas", ""), ("spheres", "spheres", ".0f"),
                ("diameters", lambda x: (
                        "equal"
                        if x["size_ratio"] == 1
                        else f"1 : {x['size_ratio']:g}, even by " + ("mass" if x["by_mass"] else "number")),
                    ""),
                ("a particle-step [ns]", lambda x: 1e9 * x["step_s"], ".0f"),
                ("over that of 20 000 equal spheres", "over_base", ".2f"),
                ("memory of a sphere [kB]", lambda x: x["bytes_a_sphere"] / 1000, ".1f")]),
    }


def dem_cores(r, csv, json):
    scenes = {x["scene"]: x for x in r["scenes"]}

    def bound(x, threads, key="speedup"):
        return next(b[key] for b in x["bounds"] if b["threads"] == threads)

    def cell(threads):
        return lambda x: f"{bound(x, threads):.1f} ({bound(x, threads, 'speedup_with_waking'):.1f})"

    return {
        "rows": table(r["scenes"], [("scene", "scene", ""), ("bodies", "bodies", "d"),
                *[(f"{n} threads", cell(n), "") for n in (2, 4, 8, 16, 32, 64)]]),
        **{f"{state}_100000_{n}": f"{bound(scenes['100 000 ' + state.replace('_', ' ')], n):.0f}"
            for state in ("at_rest", "vibrated") for n in (16, 64)},
    }


def closed_plate(r, csv, json):
    return {
        "rows": table((
                [x for x in r["trends"] if x["h_star_beyond_first"] == 0][:1]
                + [x for x in r["trends"] if x["h_star_beyond_first"] != 0]),
            (
                [("", lambda x: (
                            "initial case"
                            if x["h_star_beyond_first"] == 0
                            else f"{x['factor']} = {x['level']:g}"),
                        "")]
                + [
                    (title, lambda x, k=key: f"{1e3 * x[k]['mean']:.2f} +- {1e3 * x[k]['interval_95']:.2f}", "")
                    for title, key in (("mean [mm]", "h_star_m_mean_over_time"),
                                       ("last 2 s [mm]", "h_star_m_last_fifth"))]
                + [("mean, against the initial case [mm]", lambda x: (
                            (
                                f"{1e3 * x['h_star_beyond_first']:+.2f} +- "
                                f"{1e3 * x['h_star_beyond_first_interval_95']:.2f}")
                            if x["h_star_beyond_first"]
                            else ""),
                        ""),
                    ("share reached early",
                        lambda x: f"{x['risen_early']['mean']:.2f} +- {x['risen_early']['interval_95']:.2f}", "")])),
        "findings": table(r["findings"],
            [("the paper", lambda x: x["claim"].replace("closed plate: ", ""), ""), ("here", "numbers", ""),
                ("", "verdict", "")]),
    }
