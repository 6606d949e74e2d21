"""Calibration: parameters of a simulation from what was measured.

    python -m riddle.calibrate my_powder.yaml

    runs: 40                          # simulations in all (30)
    parallel: 4                       # side by side (1)
    parameters:
      friction: {key: contacts.glass-glass.friction, low: 0.1, high: 0.9}
      rolling:  {key: contacts.glass-glass.rolling_friction, low: 0.01, high: 0.5, log: true}
    targets:
      - {scene: heap.yaml, result: angle_deg, value: 31.5, error: 0.8}       # riddle run heap.yaml --set ...
      - {command: "hopper --friction {friction} --json {json} --out {out}", result: rate_kg_s, value: 0.212,
         error: 0.004}

Each run of the scenes or commands writes JSON; `result` is the name of a number in it, with points between
(means.rate). error is the standard error of the measured value, of repeated measurements: the mean of many simulations
is compared with it. Scenes lie beside the file, commands run where you are. Everything is written to out/my_powder, or
to the folder that follows --out: the runs (after Ctrl-C the same command goes on), result.json, result.png where
matplotlib is there, and found.set, with which any scene that has these keys takes what was found:

    riddle run hopper.yaml --set @out/my_powder/found.set

In Python the simulation is a function of your own:

    from riddle import calibrate
    found = calibrate.calibrate(lambda values, seed: {"angle": heap(values["friction"], seed)},
                                [calibrate.Parameter("friction", 0.1, 0.9)], [calibrate.Target("angle", 31.5, 0.8)])
    print(found)

Method: results over parameters are Gaussian processes (Rasmussen & Williams 2006, eq 2.25) with a linear part and
noise, over a design that fills the space. Their lengths and sizes are drawn from their own distribution, so that few
runs give wide ranges. Parameters have the distribution that measured values and processes leave, each value within its
bounds as likely as any other before. Later runs go to where this distribution lies and the processes are least certain.
"""
import concurrent.futures
import hashlib
import json
import math
import os
import shlex
import subprocess
import sys
from typing import NamedTuple

import numpy as np


class Parameter(NamedTuple):
    name: str
    low: float
    high: float
    log: bool = False  # each ratio as likely as any other


class Target(NamedTuple):
    name: str  # in what the simulation returns
    value: float
    error: float  # standard error of the measured value


# ---- a process ----

def _kernel(a, b, size, length):
    """Covariance: a plane of any slope, and what departs from it."""
    c, d = a / length, b / length
    # of the square of the way between them, negative
    halved = c @ d.T - 0.5 * np.sum(c * c, axis=1)[:, None] - 0.5 * np.sum(d * d, axis=1)
    return 9.0 * (1.0 + a @ b.T) + size * size * np.exp(np.minimum(halved, 0.0))


class _Process:
    """A result over the parameters (unit cube), as a mixture of Gaussian processes."""

    def __init__(self, x, y, rng, start=None, members=10):
        self.x, self.middle = x, float(np.mean(y))
        self.scale = float(np.std(y)) or abs(self.middle) * 1e-9 or 1.0
        self.y = (y - self.middle) / self.scale
        self.away, self.plane = (x[:, None, :] - x[None, :, :]) ** 2, 9.0 * (1.0 + x @ x.T)
        dimensions = x.shape[1]
        # lengths, size, noise: logarithms
        mean = np.concatenate([np.full(dimensions, math.log(0.7)), [0.0, math.log(0.05)]])
        sd = np.concatenate([np.full(dimensions, 0.7), [1.0, 1.5]])
        settling, between = (60 if start is None else 15), 12
        at, best, chain = (mean if start is None else start), -np.inf, []
        for step in range(settling + members * between):  # Metropolis
            trial = at + (rng.normal(size=at.size) * sd * 0.4 if step else 0.0)
            value = self._likelihood(trial) - 0.5 * float(np.sum(((trial - mean) / sd) ** 2))
            if math.log(rng.uniform() + 1e-300) < value - best:
                at, best = trial, value
            if step >= settling and (step - settling) % between == between - 1:
                chain.append(at)
        self.last = at
        self.members = [(p, *self._weights(p)) for p in chain]

    def _covariance(self, p):
        covariance = self.plane + math.exp(2.0 * p[-2]) * np.exp(-0.5 * (self.away @ np.exp(-2.0 * p[:-2])))
        covariance.flat[::len(covariance) + 1] += math.exp(2.0 * p[-1]) + 1e-10
        return covariance

    def _likelihood(self, p):
        try:
            root = np.linalg.cholesky(self._covariance(p))
        except np.linalg.LinAlgError:
            return -1e300
        rest = np.linalg.solve(root, self.y)
        return -0.5 * float(rest @ rest) - float(np.sum(np.log(np.diag(root))))

    def _weights(self, p):
        inverse = np.linalg.inv(self._covariance(p))
        return inverse @ self.y, inverse

    def predict(self, points):
        """Means and variances of the result without noise: [members, points]."""
        means, variances = [], []
        for p, weights, inverse in self.members:
            size, length = math.exp(p[-2]), np.exp(p[:-2])
            across = _kernel(points, self.x, size, length)
            own = 9.0 * (1.0 + np.sum(points * points, axis=1)) + size * size
            means.append(self.middle + self.scale * (across @ weights))
            variances.append(self.scale ** 2 * np.maximum(own - np.einsum("ij,ij->i", across @ inverse, across), 0.0))
        return np.array(means), np.array(variances)


# ---- the distribution of the parameters ----

def _spread(n, dimensions, rng):
    """Points that fill the unit cube: a Latin hypercube, the best of some by its least distance."""
    best, widest = None, -1.0
    for _ in range(40):
        points = (np.argsort(rng.uniform(size=(dimensions, n)), axis=1).T + rng.uniform(size=(n, dimensions))) / n
        away = np.sum((points[:, None] - points[None]) ** 2, axis=2) + np.eye(n) * 1e9
        if away.min() > widest:
            best, widest = points, away.min()
    return best


def _likelihood(processes, targets, points):
    """Logarithm of the likelihood of points, and the mean variance of the processes over that of the measured
    values."""
    total, doubt = np.zeros(len(points)), np.zeros(len(points))
    for process, target in zip(processes, targets):
        means, variances = process.predict(points)
        of = variances + target.error ** 2
        logs = -0.5 * (target.value - means) ** 2 / of - 0.5 * np.log(of)
        top = logs.max(axis=0)
        total += top + np.log(np.mean(np.exp(logs - top), axis=0))
        mean = means.mean(axis=0)
        doubt += (np.mean(variances, axis=0) + np.mean((means - mean) ** 2, axis=0)) / target.error ** 2
    return total, doubt


def _draw(processes, targets, dimensions, rng, n=3000, rounds=4):
    """Draws n points of the distribution of the parameters: importance sampling whose proposal follows the points."""
    points, density = rng.uniform(size=(n, dimensions)), np.ones(n)
    for left in range(rounds, 0, -1):
        logs, doubt = _likelihood(processes, targets, points)
        weights = np.exp(logs - logs.max()) / density
        weights /= weights.sum()
        if left == 1:
            break
        mean = weights @ points
        spread = np.cov(points.T, aweights=weights).reshape(dimensions, dimensions) + 1e-8 * np.eye(dimensions)
        root = np.linalg.cholesky(spread)
        chosen = points[rng.choice(n, size=150, p=weights)]
        width = 0.6
        centres = chosen[rng.integers(len(chosen), size=n)]
        fresh = centres + width * rng.normal(size=(n, dimensions)) @ root.T
        wide = rng.uniform(size=n) < 0.2
        fresh[wide] = rng.uniform(size=(int(wide.sum()), dimensions))
        fresh = fresh[np.all((fresh >= 0.0) & (fresh <= 1.0), axis=1)]
        away = np.linalg.solve(width * root, (fresh[:, None] - chosen[None]).transpose(0, 2, 1))
        normal = np.exp(-0.5
                        * np.sum(away * away, axis=1)) / ((2.0 * math.pi) ** (0.5 * dimensions) * width ** dimensions
                                                          * np.prod(np.diag(root)))
        points, density, n = fresh, 0.2 + 0.8 * normal.mean(axis=1), len(fresh)
    at = rng.choice(n, size=n, p=weights)
    return points[at], doubt[at]


# ---- the calibration ----

class Calibration:
    """What was found. values, low, high: of each parameter by name (medians, 95 % ranges); text: what the targets leave
    open."""

    def __init__(self, parameters, targets, points, predicted, runs, remarks):
        self.parameters, self.targets, self.runs, self.remarks = parameters, targets, runs, remarks
        self.points = np.array([[_value(p, u) for p, u in zip(parameters, point)] for point in points])
        low, middle, high = np.quantile(self.points, [0.025, 0.5, 0.975], axis=0)
        names = [p.name for p in parameters]
        self.low, self.values, self.high = (dict(zip(names, map(float, q))) for q in (low, middle, high))
        self.correlation = np.corrcoef(points.T).reshape(len(names), len(names))
        self.predicted = predicted

    def __str__(self):
        lines = [f"{'parameter':16}  {'value':>10}  95 % range"]
        lines += [f"{name:16}  {self.values[name]:10.4g}  {self.low[name]:.4g} .. {self.high[name]:.4g}"
                  for name in self.values]
        lines += [f"{'target':16}  {'measured':>10}  simulated there"]
        lines += [f"{t.name:16}  {t.value:10.4g}  {low:.4g} .. {high:.4g}"
                  for t, (low, high) in zip(self.targets, self.predicted)]
        return "\n".join(lines + self.remarks)

    __repr__ = __str__

    def as_dict(self):
        return {"parameters": {n: {"value": self.values[n], "low": self.low[n], "high": self.high[n]}
                               for n in self.values},
                "correlation": self.correlation.tolist(), "runs": self.runs, "remarks": self.remarks,
                "targets": [{**t._asdict(), "simulated_low": low, "simulated_high": high}
                            for t, (low, high) in zip(self.targets, self.predicted)]}


def _value(parameter, u):
    if parameter.log:
        return parameter.low * (parameter.high / parameter.low) ** u
    return parameter.low + (parameter.high - parameter.low) * u


def _check(parameters, targets, runs):
    for p in parameters:
        if not (math.isfinite(p.low) and math.isfinite(p.high) and p.low < p.high) or (p.log and not p.low > 0.0):
            raise ValueError(f"parameter {p.name}: low < high are needed" + (", above 0 with log" if p.log else ""))
    for t in targets:
        if not (math.isfinite(t.value) and math.isfinite(t.error) and t.error > 0.0):
            raise ValueError(f"target {t.name}: a value and its error above 0 are needed")
    if not parameters or not targets:
        raise ValueError("at least one parameter and one target are needed")
    if len({p.name for p in parameters}) < len(parameters) or len({t.name for t in targets}) < len(targets):
        raise ValueError("a name stands twice")
    if runs < 4 * len(parameters) + 4:
        raise ValueError(f"runs: at least {4 * len(parameters) + 4} for {len(parameters)} parameters")


def _remarks(parameters, targets, points, predicted):
    remarks = []
    correlation = np.corrcoef(points.T).reshape(len(parameters), len(parameters))
    wide = np.quantile(points, 0.975, axis=0) - np.quantile(points, 0.025, axis=0)
    for k, p in enumerate(parameters):
        if wide[k] > 0.7:
            remarks.append(f"{p.name}: the targets leave it open")
    for a in range(len(parameters)):
        for b in range(a):
            if abs(correlation[a, b]) > 0.8:
                how = "rises where the other rises" if correlation[a, b] > 0.0 else "rises where the other falls"
                remarks.append(f"{parameters[b].name} and {parameters[a].name}: the targets tell them only "
                               f"together; one {how}")
    for t, (low, high) in zip(targets, predicted):
        if not (low - 2.0 * t.error <= t.value <= high + 2.0 * t.error):
            remarks.append(f"{t.name}: no parameters within the bounds give the measured value")
    return remarks


def calibrate(run, parameters, targets, runs=30, parallel=1, seed=0, store=None, told=None, of=""):
    """Finds parameters with which run(values, seed), values a dict, returns a dict with the values of the targets. A
    run that returns None or a number that is not finite for a target says nothing about it. store: a file of the runs,
    with which a broken calibration goes on; of: what run() simulates, as text: a store of another one is refused;
    told(text): is called after each run. Returns a Calibration. ValueError: a bad argument, or too few runs that gave a
    result."""
    parameters, targets = [Parameter(*p) for p in parameters], [Target(*t) for t in targets]
    _check(parameters, targets, runs)
    rng = np.random.default_rng(seed)
    x, y = _stored(store, parameters, targets, of)
    first = min(runs, 5 * len(parameters) + 3)
    design = _spread(first, len(parameters), rng)
    processes = None
    with concurrent.futures.ThreadPoolExecutor(max_workers=max(1, parallel)) as pool:
        while len(x) < runs:
            if len(x) < first:
                batch = design[len(x):min(first, len(x) + max(1, parallel))]
            else:
                processes = _processes(x, y, targets, rng, processes)
                points, doubt = _draw(processes, targets, len(parameters), rng, 800, 3)
                batch = _next(points, doubt, x, min(max(parallel, 3), runs - len(x)))
            jobs = [pool.submit(run, {p.name: _value(p, u) for p, u in zip(parameters, at)}, 1 + seed + len(x) + k)
                    for k, at in enumerate(batch)]
            for at, job in zip(batch, jobs):
                result = job.result() or {}
                x.append([float(u) for u in at])
                y.append([float(result[t.name]) if result.get(t.name) is not None else math.nan for t in targets])
                if store:
                    with open(store, "a", encoding="utf-8") as file:
                        file.write(json.dumps({"at": x[-1], "results": [None if math.isnan(v) else v for v in y[-1]]})
                                   + "\n")
                if told:
                    told(f"run {len(x)} of {runs}")
    processes = _processes(x, y, targets, rng, processes)
    points, _ = _draw(processes, targets, len(parameters), rng)
    predicted = []
    for process in processes:
        means, variances = process.predict(points)
        drawn = means + np.sqrt(variances) * rng.normal(size=means.shape)
        predicted.append(tuple(float(q) for q in np.quantile(drawn, [0.025, 0.975])))
    return Calibration(parameters, targets, points, predicted, len(x), _remarks(parameters, targets, points, predicted))


def _processes(x, y, targets, rng, before=None):
    processes = []
    for k, target in enumerate(targets):
        told = [i for i in range(len(x)) if math.isfinite(y[i][k])]
        if len(told) < len(x[0]) + 3:
            raise ValueError(f"target {target.name}: only {len(told)} of {len(x)} runs gave a number")
        processes.append(_Process(np.array([x[i] for i in told]), np.array([y[i][k] for i in told]), rng,
                                  before[k].last if before else None))
    return processes


def _next(points, doubt, x, n):
    """The points of the distribution where the processes are least certain, each away from those that ran."""
    taken, spread = [np.array(at) for at in x], np.std(points, axis=0) + 1e-6
    batch = []
    for _ in range(n):
        away = np.min([np.sum(((points - at) / spread) ** 2, axis=1) for at in taken], axis=0)
        best = int(np.argmax(doubt * (1.0 - np.exp(-away))))
        batch.append(points[best])
        taken.append(points[best])
    return batch


def _stored(store, parameters, targets, of):
    head = json.dumps({"parameters": [p._asdict() for p in parameters], "targets": [t.name for t in targets], "of": of})
    if not store:
        return [], []
    if not os.path.exists(store):
        with open(store, "w", encoding="utf-8") as file:
            file.write(head + "\n")
        return [], []
    with open(store, encoding="utf-8") as file:
        lines = file.read().split("\n")
    if lines[0] != head:
        if lines[0].partition(', "of"')[0] == head.partition(', "of"')[0]:
            raise ValueError(f"{store} holds runs of another simulation (a scene, a command or a key has changed): "
                             "remove it, or give the old one")
        raise ValueError(f"{store} holds runs of other parameters or targets: remove it, or give the old ones")
    rows = [json.loads(line) for line in lines[1:-1]]  # a line without an end was cut off
    if lines[-1]:
        with open(store, "w", encoding="utf-8") as file:
            file.write("\n".join(lines[:-1]) + "\n")
    return [row["at"] for row in rows], [[math.nan if v is None else v for v in row["results"]] for row in rows]


# ---- the command ----

def _names(targets):
    """Of the targets of a file: their results, with what gives them where two have one name."""
    results = [t["result"] for t in targets]
    return [t["result"] if results.count(t["result"]) == 1 else f"{t.get('scene') or t['command']} {t['result']}"
            for t in targets]


class _Programs:
    """Runs the scenes and commands of a file with values, and reads their results."""

    def __init__(self, file, folder, keys, targets):
        self.folder, self.keys, self.targets = folder, keys, targets
        self.beside = os.path.dirname(os.path.abspath(file))
        self.riddle = os.environ.get("RIDDLE", "riddle")

    def what(self):
        """What the programs simulate: their commands, keys, and the text of scenes, not of files that a scene names."""
        texts = [json.dumps([self.keys] + [[t.get("scene"), t.get("command"), t["result"]] for t in self.targets])]
        for scene in sorted({t["scene"] for t in self.targets if "scene" in t}):
            with open(os.path.join(self.beside, scene), "rb") as file:
                texts.append(hashlib.sha256(file.read()).hexdigest())
        return hashlib.sha256("".join(texts).encode()).hexdigest()

    def _words(self, target, values, seed, place):
        if "scene" in target:
            scene = os.path.join(self.beside, target["scene"])
            sets = [word for name, value in values.items() for word in ("--set", f"{self.keys[name]}={value!r}")]
            return [self.riddle, "run", scene, *sets, "--seed", str(seed), "--threads", "1", "--quiet", "--json",
                    place + ".json", "--out", place]
        named = {**values, "json": place + ".json", "out": place, "seed": seed}
        return [word.format(**named) for word in shlex.split(target["command"])]

    def __call__(self, values, seed):
        results, done = {}, {}
        for name, target in zip(_names(self.targets), self.targets):
            what = target.get("scene") or target["command"]
            if what not in done:
                place = os.path.join(self.folder, f"run_{seed}_{len(done)}")
                said = subprocess.run(self._words(target, values, seed, place), capture_output=True, text=True)
                done[what] = None
                if said.returncode == 0:
                    with open(place + ".json", encoding="utf-8") as file:
                        done[what] = json.load(file)
                else:
                    print(f"{what}: {(said.stderr.strip() or 'failed').splitlines()[-1]}", file=sys.stderr)
            number, steady = done[what], True
            for word in target["result"].split("."):
                # a mean of a curve that still climbs
                steady = steady and not (isinstance(number, dict) and number.get("steady") is False)
                number = (number.get(word) if isinstance(number, dict) else number[int(word)]
                          if isinstance(number, list) else None)
            if not steady:
                print(f"{what}: {target['result']} is not steady: the run says nothing about it", file=sys.stderr)
            results[name] = number if steady and isinstance(number, (int, float)) else None
        return results


def _picture(found, name):
    try:
        import matplotlib
    except ImportError:
        return False
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    n, names = len(found.parameters), [p.name for p in found.parameters]
    figure, axes = plt.subplots(n, n, figsize=(2.4 * n + 1, 2.4 * n + 1), squeeze=False)
    for row in range(n):
        for column in range(n):
            ax = axes[row][column]
            ax.set_xlim(found.parameters[column].low, found.parameters[column].high)
            if row == column:
                ax.hist(found.points[:, row], bins=40, color="#4477aa")
                ax.set_yticks([])
            elif column < row:
                ax.plot(found.points[::4, column], found.points[::4, row], ".", markersize=2, color="#4477aa")
                ax.set_ylim(found.parameters[row].low, found.parameters[row].high)
            else:
                ax.axis("off")
            if row == n - 1:
                ax.set_xlabel(names[column])
            if column == 0 and row > 0:
                ax.set_ylabel(names[row])
    figure.tight_layout()
    figure.savefig(name, dpi=130)
    return True


_POINT = " (a decimal point is wanted)"


def _number(name, entry, key):
    try:
        return float(entry[key])
    except (TypeError, ValueError):
        raise ValueError(f"{name}: {key}: {entry[key]!r} is no number"
                         + (_POINT if "," in str(entry[key]) else "")) from None


def _read(path):
    try:
        import yaml  # type: ignore[import]
    except ImportError:
        raise SystemExit("calibrate: PyYAML is missing (Debian: python3-yaml)") from None
    try:
        with open(path, encoding="utf-8") as file:
            d = yaml.safe_load(file)
        extra = set(d) - {"runs", "parallel", "seed", "parameters", "targets"}
        if extra:
            raise ValueError(f"{sorted(extra)[0]}: not known here; runs, parallel, seed, parameters, targets are")
        for name, entry in list(d["parameters"].items()) + [("targets", t) for t in d["targets"]]:
            known = ("scene", "command", "result", "value",
                     "error") if name == "targets" else ("low", "high", "log", "key")
            other = [key for key in entry if key not in known]
            if other:  # YAML reads {value: 0,6} as the value 0 and a key 6
                raise ValueError(f"{name}: {other[0]}: not known here; {', '.join(known)} are"
                                 + (_POINT if isinstance(other[0], (int, float)) else ""))
        parameters = [Parameter(name, _number(name, p, "low"), _number(name, p, "high"), bool(p.get("log", False)))
                      for name, p in d["parameters"].items()]
        keys = {name: p.get("key", name) for name, p in d["parameters"].items()}
        for t in d["targets"]:
            if ("scene" in t) == ("command" in t):
                raise ValueError(f"target {t['result']}: a scene or a command is needed")
        targets = [Target(name, _number(name, t, "value"), _number(name, t, "error"))
                   for name, t in zip(_names(d["targets"]), d["targets"])]
        runs = int(d.get("runs", 30))
        _check(parameters, targets, runs)
        return d, parameters, keys, targets, runs
    except OSError as error:
        raise SystemExit(f"calibrate: {path}: {error.strerror}") from None
    except (ValueError, KeyError, TypeError, AttributeError, yaml.YAMLError) as error:
        what = f"{error.args[0]} is missing" if isinstance(error, KeyError) else str(error).replace("\n", " ")
        raise SystemExit(f"calibrate: {path}: {what}") from None


def main(words=None):
    words = list(sys.argv[1:] if words is None else words)
    out = None
    if "--out" in words[:-1]:
        at = words.index("--out")
        out = words[at + 1]
        del words[at:at + 2]
    if len(words) != 1 or words[0].startswith("-"):
        print(__doc__.split("\n\nIn Python")[0])
        return 0 if words == ["--help"] else 2
    d, parameters, keys, targets, runs = _read(words[0])
    out = os.path.abspath(out or os.path.join("out", os.path.splitext(os.path.basename(words[0]))[0]))
    store = os.path.join(out, "runs.jsonl")
    try:
        os.makedirs(os.path.join(out, "runs"), exist_ok=True)
    except OSError as error:
        raise SystemExit(f"calibrate: {out}: {error.strerror}") from None
    programs = _Programs(words[0], os.path.join(out, "runs"), keys, d["targets"])
    told = lambda text: print(f"\r{text}", end="", file=sys.stderr, flush=True)
    try:
        found = calibrate(programs, parameters, targets, runs, int(d.get("parallel", 1)), int(d.get("seed", 0)), store,
                          told, programs.what())
    except KeyboardInterrupt:
        print(f"\nstopped; the same command goes on with {store}", file=sys.stderr)
        return 130
    except (ValueError, OSError) as error:
        print(f"\ncalibrate: {error}", file=sys.stderr)
        return 1
    print("", file=sys.stderr)
    print(found)
    with open(os.path.join(out, "result.json"), "w", encoding="utf-8") as file:
        json.dump(found.as_dict(), file, indent=1)
    with open(os.path.join(out, "found.set"), "w", encoding="utf-8") as file:
        file.write(f"# of {words[0]}\n"
                   + "".join(f"{keys[name]}={value:.6g}\n" for name, value in found.values.items()))
    print("with: " + " ".join(f"--set {keys[name]}={value:.4g}" for name, value in found.values.items()))
    if not _picture(found, os.path.join(out, "result.png")):
        print("no picture: matplotlib is missing")
    return 0


if __name__ == "__main__":
    sys.exit(main())
